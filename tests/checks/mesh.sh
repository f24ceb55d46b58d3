#!/bin/sh
# Meshes through examples/tools/import.py (examples/tools/mesh.py): plates, an L-bracket with a lump, beams, which CalculiX solves for K and M. What
# flexbeam makes of them has the frequencies and the compliance that CalculiX has of its own, and stiffens at a spin as its own frequencies
# under centrifugal load do; decks damaged at random, others each day, are refused or read (tests/checks/mesh.py). Where there is no
# CalculiX (Debian: calculix-ccx), or no SciPy in build/venv_nastran, all is left out.
. tests/checks/common.sh

need python3 python3
python=build/venv_nastran/bin/python
"$python" -c 'import scipy' 2> /dev/null || skip "SciPy is not in build/venv_nastran: sh .ci/fetch"
command -v ccx > /dev/null || skip "no ccx (apt-get install calculix-ccx)"
! "$python" -c 'import sksparse.cholmod' 2> /dev/null || try env PYTHONPATH=examples/tools "$python" -c 'import large; large.cholmod.analyze' # it is the one that is used
try ${CC:-cc} $c99 -O0 -o "$out/integrals" tests/checks/import.c -lm
count=16
[ -z "${CHECK_ALL:-}" ] || count=400
try env OMP_NUM_THREADS=1 "$python" tests/checks/mesh.py "$out" $count "$day"
ok "$(tail -n 1 "$out/log")"
