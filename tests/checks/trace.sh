#!/bin/sh
# Rates, sensors and steps with their Jacobians (--jacobian): derivatives against differences, at states around; the rates
# themselves the tracer holds against the library, bit by bit, before it writes. What it cannot write it names. Every fourth
# model each day, and the first.
. tests/checks/common.sh
need gcc gcc
need g++ g++
worst=0 models=0 number=0

# derive NAME SENSE PRECISION COMMAND...: writes NAME.h by the command and compares
derive() {
  model=$1 sense=$2 precision=$3
  shift 3
  number=$((number + 1))
  [ $number = 1 ] || today $number || return 0
  try "$@"
  try gcc $c99 -O1 -Wno-unused-function -Wno-conversion -Wno-double-promotion -DMODEL=$model "-DHEADER=\"$model.h\"" -I"$out" ${sense:+-DSENSE=${model}_sense_$sense} \
    -o "$out/compare" tests/checks/trace.c -lm
  "$out/compare" > "$out/figures" || fail "$model: $(cat "$out/figures") (states of 20; errors of the rates, the step, a sensor)"
  [ $precision = single ] || worst=$(cat "$out/figures" | tr ' ' '\n' | tail -n 3 | sort -g | tail -n 1 | cat - "$out/worst" 2> /dev/null | sort -g | tail -n 1)
  echo "$worst" > "$out/worst"
  models=$((models + 1))
}
reduce() {
  model=$1 sense=$2 file=$3 at=${4:-0}
  shift $(($# < 4 ? $# : 4))
  derive "$model" "$sense" double build/flexbeam reduce "$file" --jacobian --name "$model" --out "$out/$model.h" --sensors "$at" "$@"
}
scene() {
  file=examples/scenes/$1.txt model=$1
  shift
  derive "$model" "${SENSE:-}" double build/flexbeam scene "$file" --jacobian "$out/$model.h" "$@"
}
reduce satellite O examples/satellite.txt 0 --vary stiffness,damping --loads 1
reduce blade O examples/blade.txt
reduce two_booms wheel examples/two_booms.txt wheel
reduce wheels O examples/satellite_wheels.txt
reduce panel O examples/panel.txt
sed -e '/^ *start_/d' -e '/^body/,/^end/!d' -e 's/^body .* beam/beam/' -e 's/\$EI/2.5e5/g' examples/scenes/gravity_gradient.txt | grep -v '^end' > "$out/center.txt"
reduce center O "$out/center.txt"
printf 'beam\nlength 4\nelements 6\nroot clamped\nhub 50 0 0 0  20 30 40\nmodes bend_y 1 bend_z 1 torsion 1\neffects full damping\ndamping 0.01\nnode 4\nstations x mass EI_y EI_z GJ i_y i_z\n0 2 400 500 200 0.01 0.02\nend\n' > "$out/torsion.txt"
reduce torsion node_1 "$out/torsion.txt" 1
scene double_pendulum
scene gimbal
scene hurty_joined
scene stops
scene functions
SENSE=hub scene satellite_control --sensors hub
scene spacecraft --loads hub
scene rotor --loads blade_1.tip,blade_3.tip
scene two_booms
derive single O single build/flexbeam reduce examples/satellite.txt --jacobian --single --name single --sensors 0 --out "$out/single.h"

# x at the start has the momentum of a wheel that turns, of its own, last, and of the whole: 0.8 N m s
{ cat examples/scenes/momentum_wheel.txt; printf 'joint fly free ground hub\nend\n'; } > "$out/begun.txt"
try build/flexbeam scene "$out/begun.txt" --jacobian "$out/begun.h" --loads hub
sed -n '/_start\[/,/}/p' "$out/begun.h" | tr -d ' \n' > "$out/start"
grep -q '8\.000000000000000[0-9]e-01.*,8\.000000000000000[0-9]e-01}' "$out/start" || fail "the start: $(cat "$out/start")"

# the filter that flies on them keeps its own bounds
try build/examples/tutorial_filter

# refused: FILE, option, what the message names
refused() {
  ! "$@" > "$out/log" 2>&1 || fail "taken: $*"
}
sed 's/effects full damping/effects large damping/' examples/satellite.txt > "$out/large.txt"
refused build/flexbeam reduce "$out/large.txt" --jacobian --out "$out/refused.h"
grep -q 'effects large: .*choose effects up to full' "$out/log" || fail "effects large: $(cat "$out/log")"
refused build/flexbeam scene examples/scenes/four_bar.txt --jacobian "$out/refused.h"
grep -q 'loops: ' "$out/log" || fail "loops: $(cat "$out/log")"
refused build/flexbeam reduce examples/satellite.txt --jacobian --sensors 7
grep -q -e '--sensors: there is no such node; choose 1 to 1' "$out/log" || fail "--sensors 7: $(cat "$out/log")"
refused build/flexbeam reduce examples/satellite.txt --jacobian --sensors 0 --sensors 1
grep -q 'take all nodes at once' "$out/log" || fail "--sensors twice: $(cat "$out/log")"
printf 'rigid\nhub 1 0 0 0 1 1 1\nnode 1 0 0 tip\nnode 2 0 0 tip_jacobian\n' > "$out/alike.txt"
refused build/flexbeam reduce "$out/alike.txt" --jacobian --sensors 1,2 --out "$out/refused.h"
grep -q 'tip and tip_jacobian would both have' "$out/log" || fail "names alike: $(cat "$out/log")"
printf 'body a rigid\n  hub 1 0 0 0 1 1 1\nend\njoint j rigid ground a\nend\nduration 1\nstep 1\n' > "$out/still.txt"
refused build/flexbeam scene "$out/still.txt" --jacobian "$out/refused.h"
grep -q 'nothing of it moves' "$out/log" || fail "no state: $(cat "$out/log")"
[ ! -e "$out/refused.h" ] || fail "a file is written in spite of a refusal"
ok "$models models, derivatives against differences within $worst of the largest of a column"
