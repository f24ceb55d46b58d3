#!/bin/sh
# Finite-element models through examples/tools/import.py, by matrices and by Nastran's files (tests/checks/import.py): mass, inertia,
# first moments and frequencies of flexbeam's bodies are those of the models and of closed forms, spinning ones stiffen as its own
# beams do; what is wrong is told. pyNastran, SciPy and NumPy are fetched by pip into build/venv_nastran (an older NumPy than that of
# FMPy); where that is out of reach the check is left out, but not in CI.
. tests/checks/common.sh
need python3 python3
python=build/venv_nastran/bin/python
"$python" -c 'import pyNastran, scipy' 2> /dev/null || { python3 -m venv build/venv_nastran && "$python" -m pip install -q pyNastran==1.4.1; } > "$out/log" 2>&1 || {
  [ -n "${CI:-}" ] && cat "$out/log" && fail "needs pyNastran (apt-get install python3-venv; build/venv_nastran/bin/pip install pyNastran)"
  ok "left out: pyNastran is not there (apt-get install python3-venv; python3 -m venv build/venv_nastran; build/venv_nastran/bin/pip install pyNastran)"
  exit 0
}
try ${CC:-cc} $c99 -O0 -o "$out/integrals" tests/checks/import.c -lm
try env OMP_NUM_THREADS=1 "$python" tests/checks/import.py "$out"
ok "$(tail -n 1 "$out/log")"
