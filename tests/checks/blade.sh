#!/bin/sh
# Blades of BeamDyn, HAWC2 and windIO through examples/tools/blade.py (tests/checks/blade.py). NumPy and PyYAML are fetched by .ci/fetch
# into build/venv_nastran; without NumPy the check is left out, without PyYAML windIO is.
. tests/checks/common.sh
need python3 python3
python=build/venv_nastran/bin/python
"$python" -c 'import numpy' 2> /dev/null || skip "NumPy is not in build/venv_nastran: sh .ci/fetch"
count=60
[ -z "${CHECK_ALL:-}" ] || count=600
try env OMP_NUM_THREADS=1 "$python" tests/checks/blade.py "$out" $count "$day"
ok "$(tail -n 1 "$out/log")"
