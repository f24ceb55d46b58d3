#!/bin/sh
# Finite-element models through examples/tools/import.py, by matrices and by Nastran's files (tests/checks/import.py): mass, inertia,
# first moments and frequencies of flexbeam's bodies are those of the models and of closed forms, spinning ones stiffen as its own
# beams do; what is wrong is told. pyNastran, SciPy and NumPy are fetched by .ci/fetch into build/venv_nastran (an older NumPy than
# that of FMPy); where they are not there the check is left out.
. tests/checks/common.sh
need python3 python3
python=build/venv_nastran/bin/python
"$python" -c 'import pyNastran, scipy' 2> /dev/null || skip "pyNastran is not in build/venv_nastran: sh .ci/fetch"
try ${CC:-cc} $c99 -O0 -o "$out/integrals" tests/checks/import.c -lm
try env OMP_NUM_THREADS=1 "$python" tests/checks/import.py "$out"
ok "$(tail -n 1 "$out/log")"
