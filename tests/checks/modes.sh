#!/bin/sh
# Modes of scenes and families of them, against SciPy and closed forms: a hinged blade over its speed by polynomials, curves that
# cross and curves that veer, blades that are equal, an overdamped hinge; names; the motion of one mode; linear models over a
# grid; frequencies chosen by body, kind and nearness; modes of rest at speed are told of; what is wrong with the words is told.
. tests/checks/common.sh
python=
for one in ${PYTHON:-} build/venv/bin/python python3 /usr/bin/python3; do
  [ -n "$python" ] || ! "$one" -c 'import numpy, scipy' > /dev/null 2>&1 || python=$one
done
[ -n "$python" ] || fail "needs NumPy and SciPy (apt-get install python3-numpy python3-scipy)"
"$python" tests/checks/modes.py "$out" > "$out/log" 2>&1 || {
  cat "$out/log"
  fail "tests/checks/modes.py"
}
ok "$(tail -n 1 "$out/log")"
