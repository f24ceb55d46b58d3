#!/bin/sh
# Wings and rotors in air: each program checks itself against what is published or closed forms, and says so by its exit
# status; aero.c checks what they do not use.
. tests/checks/common.sh
try ${CC:-cc} $c99 -O1 -o "$out/parts" tests/checks/aero.c build/library/double.o -lm
"$out/parts" > "$out/log" || fail "$(grep FAILED "$out/log")"
count=$(grep -c ' ok$' "$out/log")
for program in wing_goland ground_resonance rotor_flight; do
  try build/examples/$program --out "$out/$program.csv"
  ! grep -q FAILED "$out/log" || fail "$program ends well although a check of it failed"
  count=$((count + $(grep -c ' ok$' "$out/log")))
  [ "$(wc -l < "$out/$program.csv")" -gt 20 ] || fail "$program writes no curves"
done
try build/examples/ground_resonance --blades 3 --offset 0.5 --lag-damper 9000 --damping 15000 --out "$out/damped.csv"
try build/examples/rotor_flight --offset 0.4 --tilt-cos 1 --tilt-sin -0.5 --advance 0.1 --gj 1500 --out "$out/tilted.csv"
try ${CC:-cc} $c99 -O1 -DROTOR_BLADES=3 -o "$out/three" examples/aero/rotor_flight.c -lm
try "$out/three" --thrust 6000 --out "$out/three.csv"
status=0
build/examples/wing_goland --density 0.6 --modes 7 > "$out/log" 2>&1 || status=$?
[ $status = 2 ] && grep -q -- '--modes is 2 to 6' "$out/log" || fail "wing_goland --modes 7: exit status $status"
ok "$count comparisons with published results and closed forms"
