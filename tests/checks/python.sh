#!/bin/sh
# Scenes from other languages: the shared library exports its functions alone and compiles without a warning, its header is C99 and
# C++; the wheel is installed by pip, and the package holds what tests/checks/python.py says: the bits of the scene program, its linear
# models and modes, saved states, refusals that name file, line and word, a thousand instances, threads, SciPy, the notebook. The same
# curve by C, and by Rust, Julia and Octave where rustc, julia and mkoctfile are there.
. tests/checks/common.sh
need gcc gcc
python=
for one in ${PYTHON:-} build/venv/bin/python python3 /usr/bin/python3; do
  [ -n "$python" ] || ! "$one" -c 'import numpy, scipy' > /dev/null 2>&1 || python=$one
done
[ -n "$python" ] || fail "needs NumPy and SciPy (apt-get install python3-numpy python3-scipy)"
here=examples/bindings
library=$PWD/build/bindings
nm -D --defined-only build/bindings/libflexbeam_scene.so | sed 's/.* [A-Z] //' | sort > "$out/exported"
sed -n 's/^FBS_API .*\(fbs_[a-z_]*\)(.*/\1/p' $here/flexbeam_scene.h | sort > "$out/declared"
cmp "$out/exported" "$out/declared" || fail "what the library exports is not what flexbeam_scene.h declares"
for cc in gcc clang; do
  need $cc $cc
  try $cc $c99 -Wno-unused-function -fsyntax-only $here/flexbeam_scene.c
  try $cc -x c++ -std=c++11 $WARNINGS -Werror -fsyntax-only $here/flexbeam_scene.h
done
! grep -n 'struct fbs {\|typedef struct [^f]' $here/flexbeam_scene.h || fail "flexbeam_scene.h has a struct"

languages="C"
try gcc $c99 -I$here -o "$out/first_curve" $here/first_curve.c -Lbuild/bindings -lflexbeam_scene -Wl,-rpath,"$library"
"$out/first_curve" > "$out/c.curve" || fail "first_curve"
! "$out/first_curve" > /dev/full 2> "$out/log" || fail "first_curve ends well on a full disk"
if command -v rustc > /dev/null; then
  try rustc -D warnings -L build/bindings -o "$out/first_curve_rs" $here/first_curve.rs
  LD_LIBRARY_PATH=build/bindings "$out/first_curve_rs" > "$out/rust.curve" || fail "first_curve.rs"
  languages="$languages, Rust"
fi
if command -v julia > /dev/null; then
  julia $here/first_curve.jl > "$out/julia.curve" || fail "first_curve.jl"
  languages="$languages, Julia"
fi
if command -v mkoctfile > /dev/null; then
  try mkoctfile --mex -I$here $here/octave/flexbeam_run.c -Lbuild/bindings -lflexbeam_scene -Wl,-rpath,"$library" -o "$out/flexbeam_run.mex"
  octave-cli -q -p "$out" --eval '[t, names] = flexbeam_run("examples/scenes/rotor.txt", 2.5);
    printf("%.15g m\n", t(1 + round((0:0.5:2.5) / (t(2, 1) - t(1, 1))), 1 + find(strcmp(names, "tip_1"))));
    try; flexbeam_run("nothing.txt", 1); catch e; puts([e.message "\n"]); end' > "$out/octave.curve" 2> "$out/log" || {
    cat "$out/log"
    fail "flexbeam_run of Octave"
  }
  grep -q 'nothing.txt: No such file' "$out/octave.curve" || fail "an error of Octave: $(cat "$out/octave.curve")"
  languages="$languages, Octave"
fi

wheel=$("$python" $here/python/wheel_of_make.py "$out")
if "$python" -m pip --version > /dev/null 2>&1; then
  try "$python" -m pip install -q --disable-pip-version-check --no-index --no-deps --target "$out/site" "$out/$wheel"
else
  try "$python" -m zipfile -e "$out/$wheel" "$out/site"
fi
MPLBACKEND=Agg PYTHONDONTWRITEBYTECODE=1 PYTHONPATH="$out/site" "$python" tests/checks/python.py "$out" "$out"/*.curve > "$out/log" 2>&1 || {
  cat "$out/log"
  fail "tests/checks/python.py"
}
ok "$(tail -n 1 "$out/log"): $languages"
