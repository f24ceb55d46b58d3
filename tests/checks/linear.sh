#!/bin/sh
# Linear models as files, of `flexbeam analyse`, of scenes and of C: CSV, JSON, and .mat and .npz by examples/tools/linear.py
# agree to the last bit, names and units are what the numbers mean; poles, gains and margins by SciPy and by Octave's control
# package are those of the library and of the scenes to 1e-9. What is wrong with ports is told.
. tests/checks/common.sh
need octave-cli octave-control
python=
for one in ${PYTHON:-} python3 /usr/bin/python3; do
  [ -n "$python" ] || ! "$one" -c 'import numpy, scipy' > /dev/null 2>&1 || python=$one
done
[ -n "$python" ] || fail "needs NumPy and SciPy (apt-get install python3-numpy python3-scipy)"
octave-cli -q --eval 'pkg load control' > /dev/null 2>&1 || fail "needs Octave's control package (apt-get install octave-control)"

try ${CC:-cc} $c99 -O0 -o "$out/linear" tests/checks/linear.c build/library/double.o -lm
try "$out/linear" "$out"
cp "$out/log" "$out/modes.txt"
try ${CC:-cc} $c99 -DFB_SINGLE=1 -fsyntax-only tests/checks/linear.c
scenes=examples/scenes
try build/flexbeam scene $scenes/satellite_control.txt --quiet --linear "$out/satellite.json" --margins "$out/satellite_loop.csv"
try build/flexbeam scene $scenes/satellite_control.txt --quiet --linear "$out/satellite.csv"
try build/flexbeam scene $scenes/shaft_control.txt --quiet --linear "$out/shaft.json" --margins "$out/shaft_loop.csv"
sed '/^output/d; /^measure/d; /^expect/d' $scenes/bend45.txt > "$out/arc.txt" # the arc of examples/bend45.txt, by the same beam
for axis in x y z; do
  echo "output move_$axis displacement arc.tip $axis" >> "$out/arc.txt"
done
echo 'output turn gyro arc.tip y' >> "$out/arc.txt"
try build/flexbeam scene "$out/arc.txt" --quiet --linear "$out/arc.json"
spun="build/flexbeam analyse examples/satellite.txt --spin 0.1"
try $spun --linear "$out/spun.csv"
try $spun --linear "$out/spun.json"
grep -q '^linear model: .* 24 states, 6 inputs, 6 outputs$' "$out/log" || fail "analyse does not tell of the model: $(cat "$out/log")"
# of a free body gravity is left out, as analyse does: so is it from the body in ROM
try build/flexbeam reduce examples/satellite.txt --out "$out/rom.h"
sed -n 's/^#define .*_crc 0x\([0-9A-F]*\)u .*/\1/p' "$out/rom.h" > "$out/crc.txt"
sed 's/^modes 4$/modes 6/' examples/bend45.txt > "$out/bend.txt"
bent="build/flexbeam exact $out/bend.txt --linear"
try $bent "$out/bent.json"
try $bent "$out/bent.csv"
grep -q '^linear model: .* 12 states, 6 inputs, 6 outputs$' "$out/log" || fail "exact does not tell of the model: $(cat "$out/log")"
for force in 600.5 599.5; do # what a static response has to be
  sed "s/dead 0 0 600$/dead 0 0 $force/" examples/bend45.txt > "$out/bend_$force.txt"
  grep -q "dead 0 0 $force$" "$out/bend_$force.txt" || fail "examples/bend45.txt has no load of 600"
  try build/flexbeam exact "$out/bend_$force.txt" --linear "$out/bent_$force.json"
done
# E10.29: the slowest motion of 0.98636448 Hz has that part of the ratio 0.02 at 5 Hz
printf 'length 2\nelements 16\nstation 0\nstiffness 1e6 0 0 80 100 300\ninertia 2 2 2 0.02 0.01 0.01\ndamping_ratio 0.02 5\nmodes 1\n' > "$out/damped.txt"
try build/flexbeam exact "$out/damped.txt"
awk '$1 == 1 { f = $2; growth = $4 } END { r = growth / (-0.02 * f / 5 * 2 * 3.14159265358979 * f); exit !(r > 0.999 && r < 1.001) }' "$out/log" ||
  fail "damping of an exact beam: $(tail -n 1 "$out/log")"
cat > "$out/hinged.txt" << END
length 1
elements 4
station 0
  stiffness 1e6 1e6 1e6 10 10 10
  mass 1
joint 0.5 0 1 0 stiffness 3 damping 0.1
modes 4
END
try build/flexbeam exact "$out/hinged.txt" --linear "$out/hinged.json" --inputs drive.0,force.tip.z --outputs coordinate.0,speed.0,displacement.tip.z
cat > "$out/flap.txt" << END # a blade on a flap hinge, which spins with its base
trim
body blade exact
  length 1
  elements 20
  start_spin 0 0 6
  root x y z rx rz
  station 0
    stiffness 1e6 1e6 1e6 10 1 1
    mass 1
  node tip tip
end
output turn gyro blade.tip y
load blade.tip follower force 0 0 1 constant 0
END
try build/flexbeam scene "$out/flap.txt" --quiet --linear "$out/flap.json"
for model in spinning system satellite shaft spun exact bent arc; do
  try "$python" examples/tools/linear.py "$out/$model.json" "$out/$model.mat" "$out/$model.npz"
done
octave-cli -q tests/checks/linear.m "$out" > "$out/octave.txt" 2> "$out/log" || {
  cat "$out/log"
  fail "Octave"
}
try "$python" tests/checks/linear.py "$out"
figures=$(tail -n 1 "$out/log" | tr -d '{}"')
for model in satellite shaft; do # the scene's margins, to all their digits
  try build/flexbeam scene "$out/${model}_known.txt" --quiet
done

# refuse STATUS TEXT COMMAND...
refused=0
refuse() {
  status=0
  want=$1
  text=$2
  shift 2
  "$@" > "$out/log" 2>&1 || status=$?
  [ $status = "$want" ] && grep -q -F -e "$text" "$out/log" || fail "$*: not '$text' and status $want but $status and $(cat "$out/log")"
  refused=$((refused + 1))
}
refuse 2 "--inputs: push.0.x: no such kind" $spun --linear "$out/no.json" --inputs push.0.x
refuse 2 "--inputs: rate.0.x: no such kind" $spun --linear "$out/no.json" --inputs rate.0.x
refuse 2 "--outputs: force.0.x: no such kind" $spun --linear "$out/no.json" --outputs force.0.x
refuse 2 "--inputs: force.0.w: wants .x, .y or .z" $spun --linear "$out/no.json" --inputs force.0.w
refuse 2 "--inputs: force: wants .x, .y or .z" $spun --linear "$out/no.json" --inputs force
refuse 2 "--inputs: force.9.x: no such node" $spun --linear "$out/no.json" --inputs force.9.x
refuse 2 "--inputs: force.x: no such node" $spun --linear "$out/no.json" --inputs force.x
refuse 2 "--inputs: base_rate.0.x: the base has no node" $spun --linear "$out/no.json" --inputs base_rate.0.x
refuse 2 "more than 96 of them" $spun --linear "$out/no.json" --inputs "$(echo 'force.0.x,torque.0.y,force.1.x,torque.0.z,' | tr -d '\n' | sed 's/.*/&&&&&/; s/.*/&&&&&/')"
refuse 1 "no linear model: " $spun --linear "$out/no.json" --inputs base_rate.x
refuse 2 "--inputs and --outputs are those of --linear" $spun --inputs force.0.x
refuse 2 "cannot write $out/no/no.json" $spun --linear "$out/no/no.json"
refuse 2 "--inputs: rate.tip.x: no such kind" $bent "$out/no.json" --inputs rate.tip.x
refuse 2 "--inputs: force.41.x: no such node" $bent "$out/no.json" --inputs force.41.x
refuse 2 "--outputs: internal_moment.40.x: no such element" $bent "$out/no.json" --outputs internal_moment.40.x
refuse 2 "--inputs: base_rate.0.x: the base has no node" $bent "$out/no.json" --inputs base_rate.0.x
refuse 1 "that is held along the axis" $bent "$out/no.json" --inputs support_displacement.tip.x
refuse 2 "--outputs: support_rotation.tip.x: no such kind" $bent "$out/no.json" --outputs support_rotation.tip.x
refuse 2 "drive.1: no such joint" build/flexbeam exact "$out/hinged.txt" --linear "$out/no.json" --inputs drive.1
refuse 2 "coordinate.0: no such kind" build/flexbeam exact "$out/hinged.txt" --linear "$out/no.json" --inputs coordinate.0
refuse 2 "--inputs and --outputs are those of --linear" build/flexbeam exact "$out/bend.txt" --inputs force.tip.x
sed '/^trim/d; s/^body arc/duration 1\ninterval 0.1\nbody arc/' "$out/arc.txt" > "$out/loose.txt"
refuse 2 "about its steady state alone: add a line trim" build/flexbeam scene "$out/loose.txt" --quiet --linear "$out/no.json"
cp "$out/bend.txt" "$out/same.txt" # what is read stays
refuse 2 "--linear: that is the description itself" build/flexbeam exact "$out/same.txt" --linear "$out/../${out##*/}/same.txt"
refuse 2 "--out: that is the description itself" build/flexbeam exact "$out/same.txt" --out "$out/same.txt"
cmp -s "$out/bend.txt" "$out/same.txt" || fail "a description is written over by exact"
cp examples/satellite.txt "$out/same.txt"
refuse 2 "--linear: that is the description itself" build/flexbeam analyse "$out/same.txt" --linear "$out/same.txt"
cmp -s examples/satellite.txt "$out/same.txt" || fail "a description is written over by analyse"
refuse 2 "that is the scene itself" build/flexbeam scene $scenes/top.txt --linear $scenes/top.txt
echo "{}" > "$out/rom.json"
refuse 1 "no linear model of flexbeam" "$python" examples/tools/linear.py "$out/rom.json" "$out/no.mat"
refuse 1 "wants .mat or .npz" "$python" examples/tools/linear.py "$out/spun.json" "$out/no.csv"
ok "$figures; $refused refusals"
