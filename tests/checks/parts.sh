#!/bin/sh
# Bodies of parts: a description against the same model by C calls, its parts placed and turned, damped each for itself, in ROM;
# advise and analyse take it; what is wrong with a file is told with its line.
. tests/checks/common.sh
need gcc gcc
try build/flexbeam reduce examples/two_booms.txt --name rom_body --out "$out/rom.h"
grep -q 'left: effective mass' "$out/log" || fail "reduce tells nothing of the left boom"
try gcc $c99 -I"$out" -O1 -o "$out/parts" tests/checks/parts.c build/library/tool.o -lm
try "$out/parts" "$out"
figures=$(tail -n 1 "$out/log")

# roots of the equation of a hub with two beams: both bend along y or z, or against each other; two modes of a plane are a little stiffer
try build/flexbeam analyse examples/two_booms.txt --modes 10
awk 'BEGIN { split("0.556348344 0.556348344 0.985076724 1.07648635", hz, " ") }
  $1 == "mode" { reads = 1; next } !/^ *[0-9]/ { reads = 0 } reads && $4 > 0.1 && k < 4 { k++; off = $4 / hz[k] - 1; wrong += off < -1e-5 || off > 6e-4 }
  END { exit k != 4 || wrong > 0 }' "$out/log" || fail "other frequencies than in closed form: $(cat "$out/log")"
try build/flexbeam advise examples/two_booms.txt --torque 0,0,0,5 --frequency 0.1
grep -q '^ *[0-9]* *bend_y .* left ' "$out/log" && grep -q '^  beam left:$' "$out/log" || fail "advise does not name the parts"
sed -n '/^1 %: [A-Z]/,/^$/p' "$out/log" | grep -A1 '^  beam' | grep -q '^    modes bend_y' || fail "advise does not say which modes of a part"

# damping of parts whose modes are not orthogonal counts modes by frequency, others by coordinate: nothing is selected among them
sed -e 's/^effects full$/effects full damping/' -e '/position 0.5 0 0.1/s/$/\n  damping 0.01/' -e '/position 0.7 -1.1 0.4/s/$/\n  damping 0.03/' \
  "$out/placed.txt" > "$out/damped.txt"
try build/flexbeam reduce "$out/damped.txt" --out "$out/damped.h"
for mode in 1:0.01 4:0.01 5:0.03 6:0.03; do
  grep -q "^  mode  ${mode%:*} .* damping ${mode#*:}$" "$out/log" || fail "mode $mode: $(cat "$out/log")"
done
! build/flexbeam advise "$out/damped.txt" > "$out/log" 2>&1 && grep -q 'want one damping ratio here' "$out/log" || fail "advise takes damping by frequency"

# a section of no material in SI units is told by what reads descriptions, with its line; not one that is
for program in reduce advise analyse; do
  case $program in
    reduce) set -- --out "$out/boom.h" ;;
    advise) set -- --torque 0,0,0,5 --frequency 0.1 ;;
    analyse) set -- ;;
  esac
  for EA in 31724000 31.724; do
    sed -e 's/mass EI_y/mass EA EI_y/' -e "s/^0 1.2 /0 1.2 $EA /" -e 's/^base prescribed/hub 50  0 0 0  9 9 9/' examples/boom.txt > "$out/unit.txt"
    build/flexbeam $program "$out/unit.txt" "$@" > "$out/log" 2>&1 || fail "$program of a boom: $(cat "$out/log")"
    [ "$(grep -c 'unit.txt: warning: line 13: at x = 0 sqrt(EA/mass) = 5.14 m/s, of no material .*: E in N/mm^2' "$out/log")" = $([ $EA = 31.724 ] && echo 1 || echo 0) ] ||
      fail "$program of a boom with EA of $EA says: $(cat "$out/log")"
  done
done

# a wheel along pitch: nutation h/sqrt(J_x J_z), at a spin W about pitch sqrt((h + (J_y - J_z) W)(h + (J_y - J_x) W)/(J_x J_z)), h with
# I W; friction lets its speed decay at d (1/I + 1/J_y), and its motor balances it
gyrostat() {
  printf 'rigid\nhub 50  0 0 0  2 3 4.5\nrotor wheel\n  axis 0 2 0\n  inertia 0.01\n  speed 80\n  damping 1e-3\nend\n' > "$out/gyrostat.txt"
  try build/flexbeam analyse "$out/gyrostat.txt" --spin "0,$1,0"
  awk -v W="$1" 'function near(x, y) { return x - y < 5e-6 * y && y - x < 5e-6 * y }
    BEGIN { h = 0.8 + 0.01 * W; nutation = sqrt((h - 1.5 * W) * (h + W) / 9) }
    /^  rotor wheel: 80 rad/ && $11 == 0.08 { held = near($6, h) }
    near($3, nutation) { nutates = 1 } $3 == 0 && $2 > -0.10035 && $2 < -0.10032 { decays = 1 }
    END { exit !(held && nutates && decays) }' "$out/log" || fail "a gyrostat at $1 rad/s: $(cat "$out/log")"
}
gyrostat 0
gyrostat 0.3
try build/flexbeam analyse examples/satellite_wheels.txt --linear "$out/wheels.csv" --inputs motor.pitch,torque.bench.y --outputs rotor_speed.0,rate.0.y
for option in '--inputs motor.bench' '--inputs rotor_speed.pitch' '--outputs motor.pitch'; do
  ! build/flexbeam analyse examples/satellite_wheels.txt --linear "$out/wheels.csv" $option > "$out/log" 2>&1 || fail "analyse takes $option"
done
try build/flexbeam reduce examples/satellite_wheels.txt --out "$out/wheels.h"
grep -q 'rotor 0  pitch: 400 rad/s at the start, which the header has not' "$out/log" || fail "reduce does not tell of the speed of a rotor"
try build/flexbeam reduce examples/satellite_wheels.txt --code --out "$out/wheels.h"
grep -q 'rotor 0  pitch: 400 rad/s at the start, .* rotor_momentum' "$out/log" || fail "reduce --code does not tell where the speed of a rotor goes"

# refuse LINE TEXT: of the file at the standard input
: > "$out/refused"
refuse() {
  cat > "$out/bad.txt"
  ! build/flexbeam reduce "$out/bad.txt" --out "$out/bad.h" 2> "$out/log" || fail "taken: $2"
  grep -q -F -e "bad.txt$([ "$1" = 0 ] || echo ":$1"): $2" "$out/log" || fail "not '$1: $2' but $(cat "$out/log")"
  echo "$2" >> "$out/refused"
}
boom='length 8
elements 4
modes bend_y 1
stations x mass EI_z
0 1 1000
end'
wing='modes 1
frequency_hz 1
node 1 1 0 0 2
node 2 2 0 0 2
shape 1 1 0 0 1 0 0 0
shape 1 2 0 0 2 0 0 0'
# whole LINES...: a hub, effects linear, these lines
whole() {
  printf 'parts\nhub 10 0 0 0 1 1 1\neffects %s\n' "$1"
  shift
  printf '%s\n' "$@"
}
whole linear "beam a" "$boom" end "component b" "$wing" end > "$out/good.txt"
try build/flexbeam reduce "$out/good.txt" --out "$out/good.h"
whole linear "beam a" "$boom" end "beam a" "$boom" end | refuse 12 "two parts have the name a"
whole linear "beam" "$boom" end | refuse 4 "the name of a part is missing"
whole linear "beam a b" "$boom" end | refuse 4 "too much on the line: b"
whole linear "beam a" "$boom" | refuse 10 "beam a of line 4 wants a line \`end\`"
whole linear "beam a" "$boom" "hub 1 0 0 0 1 1 1" end | refuse 11 "no such word for a beam: hub"
whole linear "beam a" "$boom" "effects full" end | refuse 11 "no such word for a beam: effects"
whole linear "beam a" "$boom" "frequency_hz 1" end | refuse 11 "no such word for a beam: frequency_hz"
whole linear "beam a" "$boom" "length 3" end | refuse 11 "length is there twice"
whole linear "beam a" "$boom" "root free" end | refuse 11 "a beam with a free root is not held by the hub: root clamped"
whole linear "beam a" "$boom" "root pinned" end | refuse 11 "modes of a pinned root leave out its rotation: root clamped, or functions"
whole linear "beam a" "length 8" "modes bend_y 1" end | refuse 4 "a beam wants stations or taper"
whole linear "beam a" "$boom" "node 9" end | refuse 4 "a node at 9 is beyond the tip at 8"
whole linear "beam a" "$boom" "node tip x" end "beam b" "$boom" "node tip x" end | refuse 20 "two nodes have the name x"
whole linear "beam a" "$boom" "attitude x" end | refuse 11 "degrees is missing"
whole linear "beam a" "$boom" "attitude 0 0 0 0" end | refuse 11 "an attitude must not be zero"
whole linear "beam a" "$boom" "position 1 2" end | refuse 11 "position, number 3 of 3 is missing"
whole linear "beam a" "$boom" "damping 0.1" end | refuse 11 "damping is given, but not among the effects"
whole "linear damping" "beam a" "$boom" end | refuse 3 "the effect damping wants a line damping"
whole "linear damping" "damping 0.1 0.1" "beam a" "$boom" "damping 0.1" end |
  refuse 4 "damping of the whole has one ratio where a part has its own"
whole "linear damping" "beam a" "$boom" "damping 0.1 0.2" end | refuse 0 "beam a, damping wants one ratio, or as many as the part has modes"
whole linear "beam a" "$boom" end "component b" "$wing" "shape 1 3 0 0 1 0 0 0" end | refuse 19 "no node has the number 3"
whole linear "component a" "$wing" end "component b" "modes 1" "frequency_hz 1" "shape 1 1 0 0 1 0 0 0" end |
  refuse 15 "no node has the number 1"
whole linear "component b" "modes 1" "frequency_hz 1" "node 1 1 0 0 2" end | refuse 4 "node 1 has no shape of mode 1"
whole full "beam a" "$boom" end "component b" "$wing" end | refuse 12 "stiffening wants line, geometric or quadratic lines"
# line LINES...: that component, with effects full, and these lines
line() {
  printf 'component\nhub 10 0 0 0 1 1 1\neffects full\n%s\n' "$wing"
  printf '%s\n' "$@"
}
line "line frame 0 0 0 1 2" > "$out/good.txt"
try build/flexbeam reduce "$out/good.txt" --out "$out/good.h"
line "line 1" | refuse 10 "a line wants two places at least"
line "line frame 0 0 0 1 3" | refuse 10 "no node has the number 3"
line "line frame 0 0 0 1" "line 2 1" | refuse 11 "node 1 is on a line before: a line begins there, or leaves it out"
line "line frame 0 0 0 1" | refuse 0 "node 2 moves, and is on no line"
line "line frame 1 0 0 1 2" > "$out/bad.txt"
! build/flexbeam reduce "$out/bad.txt" --out "$out/bad.h" 2> "$out/log" && grep -q -F "node 1: a value is out of its range" "$out/log" || fail "$(cat "$out/log")"
line "line frame 0 0 0 1 2" "geometric 1 1  1 0 0 0 0 0 0 0 1 0 0 0" |
  refuse 0 "the second order of a component is given by line, by geometric or by quadratic, not by two of them"
line "geometric 1 1 1 0 0" | refuse 10 "stiffness by accelerations x y z, angular ones x y z, spins xx yy zz xy xz yz, number 4 of 12"
whole linear "component b" "modes 20" end "component c" "modes 5" end | refuse 4 "a component wants modes"
whole linear "stations x" | refuse 4 "no such word for a body of parts (hub, beam, component, node): stations"
whole linear "end" | refuse 4 "no such word for a body of parts (hub, beam, component, node): end"
whole linear "beam a" "$(echo "$boom" | sed s/0.1.1000/0\ 1\ 0/)" end | refuse 0 "beam a, its modes: "
for k in 1 2 3 4 5 6 7 8 9; do
  echo "component c$k"
  echo "$wing"
  echo end
done > "$out/nine"
whole linear "$(cat "$out/nine")" | refuse 68 "more than 8 parts"
printf 'rigid\nhub 1 0 0 0 1 1 1\nbeam a\nend\n' | refuse 3 "no such word for a rigid body: beam"
# turns LINES...: a rigid body with a rotor of these lines
turns() {
  printf 'rigid\nhub 1 0 0 0 1 1 1\nnode 1 0 0 here\nrotor w here\n'
  printf '%s\n' "$@"
}
turns "axis 1 0 0" "inertia 1" end > "$out/good.txt"
try build/flexbeam reduce "$out/good.txt" --out "$out/good.h"
turns "axis 1 0 0" "inertia 1" | refuse 6 "rotor w of line 4 wants a line \`end\`"
turns "axis 1 0 0" end | refuse 4 "rotor w wants an inertia"
turns "inertia 1" end | refuse 4 "rotor w wants an axis, not zero"
turns "axis 1 0 0" "inertia 0" end | refuse 6 "inertia must be greater than 0"
turns "axis 1 0 0" "inertia 1 2" end | refuse 6 "too much on the line: 2"
turns "axis 1 0 0" "axis 1 0 0" end | refuse 6 "axis is there twice"
turns "axis 1 0 0" "inertia 1" "motor constant 1" end | refuse 7 "the motor of a rotor is not in its description"
turns "axis 1 0 0" "inertia 1" "momentum 1" "speed 1" end | refuse 8 "speed of a rotor whose momentum is given"
turns "axis 1 0 0" "inertia 1" "momentum" end | refuse 7 "momentum is missing"
turns "axis 1 0 0" "inertia 1" "spin 1" end | refuse 7 "no such word for a rotor: spin"
turns "axis 1 0 0" "inertia 1" end "rotor w" "axis 1 0 0" "inertia 1" end | refuse 8 "two rotors have the name w"
turns "axis 1 0 0" "inertia 1" end "rotor v there" "axis 1 0 0" "inertia 1" end | refuse 8 "rotor v: no node has the name or number there"
turns "axis 1 0 0" "inertia 1" end "rotor v 2" "axis 1 0 0" "inertia 1" end | refuse 8 "rotor v: no node has the name or number 2"
whole linear "component b" "$wing" "mark 1 tip" "mark 2 tip" end "rotor w tip" "axis 1 0 0" "inertia 1" end |
  refuse 14 "rotor w: two nodes have the name tip"
long=a123456789b123456789c123456789d
{ printf 'rigid\nhub 1 0 0 0 1 1 1\nnode 1 0 0 %s\n' $long && printf 'rotor w %se\naxis 1 0 0\ninertia 1\nend\n' $long; } | refuse 4 "rotor w: no node has the name or number ${long}e"
turns "axis 1 0 0" "inertia 1" end "rotor" | refuse 8 "the name of a rotor is missing"
whole linear "beam a" "$boom" "rotor w" end | refuse 11 "no such word for a beam: rotor"
turns "axis 1 0 0" "inertia 1" end "$(for k in 1 2 3 4; do printf 'rotor r%s\naxis 1 0 0\ninertia 1\nend\n' $k; done)" | refuse 20 "more than 4 rotors"
ok "$figures; $(wc -l < "$out/refused") malformed files refused"
