#!/bin/sh
# FMUs of bodies: FMPy validates and simulates them, they move as the library does to the last bit (tests/checks/fmu.py); their
# C has no warnings; without a heap they call none; a controller by SciPy holds one. FMUs of scenes move as their runs do
# (tests/checks/fmu_scene.py), in a second importer too (tests/checks/fmu_second.py). FMPy and SciPy are
# fetched by .ci/fetch into build/venv; where they are not there the check is left out.
. tests/checks/common.sh
need python3 python3
need zip zip
long=$(printf 'n%062d' 0) # the longest name; nodes of which one has the name that another would get
printf 'rigid\nname %s\nhub 9 0 0 0 1 1 1\nbase free\neffects rigid\nnode 1 0 0 node2\nnode 0 1 0\nnode 0 0 1 start\n' "$long" > "$out/names.txt"
for version in 2 3; do
  try env CC=' gcc  -O0 ' build/flexbeam fmu "$out/names.txt" --version $version --out "$out/names.fmu"
  rm -rf "$out/names"
  try python3 -m zipfile -e "$out/names.fmu" "$out/names"
  try python3 -c 'import ctypes, sys; ctypes.CDLL(sys.argv[1])' "$(echo "$PWD/$out"/names/binaries/*/"$long".*)"
  nodes=$(sed -n 's/.*name="\([^"]*\)\.force[["].*/\1/p' "$out/names/modelDescription.xml" | uniq | tr '\n' ' ')
  [ "$nodes" = "hub node2 node6 node3 " ] || fail "names of nodes: $nodes"
done
! CC='no_such_compiler -O1' build/flexbeam fmu "$out/names.txt" --out "$out/none.fmu" 2> "$out/log" || fail "a compiler that is not there"
grep -q 'there is no compiler no_such_compiler ' "$out/log" || fail "no compiler: $(cat "$out/log")"
mkfifo "$out/pipe" # what is no file of its own stays as it is
ln -s names.fmu "$out/link"
for other in pipe link; do
  ! build/flexbeam fmu "$out/names.txt" --out "$out/$other" 2> "$out/log" || fail "--out $other is taken"
  grep -q 'a link, a device, a pipe' "$out/log" || fail "--out $other: $(cat "$out/log")"
done
cp "$out/names.txt" "$out/own.txt"
! build/flexbeam fmu "$out/own.txt" --out "$out/own.txt" 2> "$out/log" || fail "--out of the description itself is taken"
grep -q 'that is the description itself' "$out/log" && cmp -s "$out/names.txt" "$out/own.txt" || fail "--out own.txt: $(cat "$out/log")"
[ -p "$out/pipe" ] && [ -L "$out/link" ] || fail "--out replaces a pipe or a link"
rm "$out/pipe" "$out/link"
python=build/venv/bin/python
"$python" -c 'import fmpy, scipy' 2> /dev/null || skip "FMPy and SciPy are not in build/venv: sh .ci/fetch"
cp examples/satellite.txt examples/two_booms.txt examples/panel.txt "$out"
sed 's/^base free/base prescribed/' examples/satellite.txt > "$out/held.txt"
sed 's/^effects full damping/effects linear damping/' examples/satellite.txt > "$out/linear.txt"
sed 's/^effects full damping/effects large damping/' examples/satellite.txt > "$out/large.txt"
for model in satellite two_booms panel held linear large names; do
  for version in 2 3; do
    [ $model$version = satellite2 ] && level=-O2 || level=-O0 # one is timed
    try env CC="gcc $level" build/flexbeam fmu "$out/$model.txt" --version $version --out "$out/$model$version.fmu"
  done
done
try env CC="gcc -O0" build/flexbeam fmu examples/satellite.txt --static --out "$out/static2.fmu"
# their binaries are those of all scenes: by make, and from the sources
try env -u CC build/flexbeam fmu examples/scenes/satellite_control.txt --out "$out/scene2.fmu"
"$python" -m zipfile -e "$out/scene2.fmu" "$out/scene2"
cmp -s build/tool/fmu2.so "$out"/scene2/binaries/*/satellite_control.so || fail "the FMU of a scene has not the binary that make has built"
try env CC="gcc -O0" build/flexbeam fmu examples/scenes/satellite_control.txt --version 3 --out "$out/scene3.fmu"
for fmu in static2 satellite3 scene3; do
  mkdir "$out/$fmu"
  try "$python" -m zipfile -e "$out/$fmu.fmu" "$out/$fmu"
done
nm -D -u "$out"/static2/binaries/*/satellite.so | grep -E '(malloc|calloc|realloc|free)' && fail "a static FMU calls the heap"
for cc in gcc clang; do # the headers of FMI are not ours: they have no warnings here
  need $cc $cc
  for version in 2 3; do
    try $cc $c99 -fsyntax-only -DFMU_STATIC=$((version - 2)) -Iexamples/common -I"$out/$([ $version = 2 ] && echo static2 || echo satellite3)/sources" \
      -isystem examples/fmu/fmi$version examples/fmu/fmu$version.c
  done
  try $cc $c99 -fsyntax-only -I"$out/scene3/sources/examples/fmu" -isystem examples/fmu/fmi3 examples/fmu/fmu3.c
done
sed 's/^damping 0.003/damping 0.006/' examples/satellite.txt > "$out/damped.txt"
grep -q '^damping 0.006' "$out/damped.txt" || fail "examples/satellite.txt has no damping 0.003"
try gcc $c99 -O1 -o "$out/reference" tests/checks/fmu.c build/library/tool.o -lm
try env CC="gcc -O0" build/flexbeam fmu examples/satellite.txt --out "$out/again.fmu"
for part in modelDescription.xml sources/fmu_model.h; do # the same model: the same token, the same texts
  for fmu in satellite2 again; do
    try "$python" -c "import sys, zipfile; sys.stdout.buffer.write(zipfile.ZipFile('$out/$fmu.fmu').read('$part'))"
    mv "$out/log" "$out/$fmu.part"
  done
  cmp -s "$out/satellite2.part" "$out/again.part" || fail "$part of the same model is not the same twice"
done
! build/flexbeam fmu examples/satellite_wheels.txt --out "$out/wheels.fmu" 2> "$out/log" || fail "rotors are taken"
grep -q 'rotor pitch: an FMU has no rotors' "$out/log" || fail "rotors: $(cat "$out/log")"
printf 'beam\nlength 10\nelements 3\nstations x mass EA EI_z\n0 1.2 3e7 14004\nend\nfunctions 3 root_strain\nmodes bend_y 6 axial 6\neffects strain\nbase prescribed\nnode 10 tip\n' > "$out/strain.txt"
! build/flexbeam fmu "$out/strain.txt" --out "$out/strain.fmu" 2> "$out/log" || fail "effects strain are taken"
grep -q 'effects strain: the FMU of a body has none' "$out/log" || fail "strain: $(cat "$out/log")"
ls "$out"/*.fmu.* > /dev/null 2>&1 && fail "folders are left behind"
try "$python" examples/fmu/attitude.py "$out/satellite2.fmu"
grep -q '^inertia about z 402' "$out/log" || fail "the inertia that a torque meets: $(cat "$out/log")"
"$python" tests/checks/fmu.py "$out" "$out/reference" > "$out/log" 2>&1 || {
  cat "$out/log"
  fail "tests/checks/fmu.py"
}
figures=$(tail -n 1 "$out/log")
for version in 2 3; do # a scene has that name, too
  try cp "$out/satellite$version.fmu" "$out/body$version.fmu"
done
"$python" tests/checks/fmu_scene.py "$out" "$out/reference" > "$out/log" 2>&1 || {
  cat "$out/log"
  fail "tests/checks/fmu_scene.py"
}
figures="$figures; $(tail -n 1 "$out/log")"
second="a second importer is left out: build/venv has no ecospy and tbb (sh .ci/fetch)"
if "$python" -c 'import importlib.util, sys; sys.exit(not importlib.util.find_spec("ecospy"))'; then
  "$python" tests/checks/fmu_second.py "$out" "$out/reference" > "$out/log" 2>&1 || {
    cat "$out/log"
    fail "tests/checks/fmu_second.py"
  }
  second=$(grep '^Ecos ' "$out/log")
fi
ok "$figures; $second"
