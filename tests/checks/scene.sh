#!/bin/sh
# flexbeam scene: every scene of examples/scenes meets its references; scenes run again and again in one process give the
# same bits, and write nothing unless asked to; pictures are well-formed; malformed files are refused with the right line
# and reason, by a program under the sanitizers.
. tests/checks/common.sh
try ${CC:-cc} $c99 -O0 -o "$out/again" tests/checks/scene.c build/library/tool.o -lm

scenes=0
for file in examples/scenes/*.txt; do
  scene=$(basename "$file" .txt)
  try build/flexbeam scene "$file" --quiet --out "$out/$scene.csv" --animation "$out/$scene.svg"
  [ ! -s "$out/log" ] || fail "$scene says: $(cat "$out/log")"
  grep -q '</svg>' "$out/$scene.svg" || fail "$scene: the picture is not whole"
  ! grep -q nan "$out/$scene.csv" "$out/$scene.svg" || fail "$scene: not a number"
  scenes=$((scenes + 1))
done
try "$out/again" examples/scenes/slider_crank.txt examples/scenes/spinup_auto.txt examples/scenes/dead_load.txt
[ ! -s "$out/log" ] || fail "scene_run says: $(cat "$out/log")"

try build/flexbeam scene examples/scenes/double_pendulum.txt --quiet --frames "$out/frames" --frame-count 5 --picture "$out/picture.svg"
[ "$(ls "$out/frames" | wc -l)" = 5 ] && grep -q '</svg>' "$out/frames/frame_0005.svg" "$out/picture.svg" || fail "frames are missing"

# signs of the ground: a pivot, a wall, one that slides with what it holds; none where nothing is held; the scale
# drawn SCENE GROUND SCALE OPTION: so many signs, and what stands at the bar
drawn() {
  try build/flexbeam scene "examples/scenes/$1.txt" --quiet "$4" "$out/drawn.svg"
  [ "$(grep -c 'stroke="#333333"' "$out/drawn.svg")" = "$2" ] || fail "$1 $4: not $2 signs of the ground"
  [ "$(grep -c ">$3</text>" "$out/drawn.svg")" = $([ "$3" = none ] && echo 0 || echo 1) ] || fail "$1 $4: the scale is not $3"
}
drawn double_pendulum 1 "1 m" --picture
drawn double_pendulum 1 "1 m" --animation
drawn four_bar 2 "0.2 m" --picture
drawn slider_crank 2 "0.1 m" --animation
drawn postbuckling 1 "0.2 m" --picture
drawn shaft_whirl 2 "0.2 m" --picture
drawn tip_moment 1 "2 in" --picture
drawn deployment 0 "1 m" --picture
drawn top 0 none --picture
grep -c '<animate attributeName="points"' "$out/slider_crank.svg" | grep -q '^5$' || fail "slider_crank: not three bodies, a link and a sign move"

# the modal beam and the exact one from the same description, and parameters
try build/flexbeam scene examples/scenes/spinup_rate.txt --quiet --set exact=10 --set spin=6
! build/flexbeam scene examples/scenes/spinup_rate.txt --quiet --set modes=1 > "$out/log" || fail "one mode is as good as three"
grep -q MISSED "$out/log" || fail "nothing is said of a reference that is missed"

# [DB] 4.3: with Q = 1 the response diverges; tests/reference/p07_Q.csv: at 1.11 s
! build/flexbeam scene examples/scenes/spinup_first_q2.txt --quiet --set Q=1 > "$out/log" 2>&1 || fail "Q = 1 does not diverge"
grep -q 'at 1\.1[01][0-9]* s, step of' "$out/log" || fail "Q = 1 diverges elsewhere: $(cat "$out/log")"

# beyond Euler's load, pi^2/4 EI/L^2, the straight column is a steady state, and unstable to both sides
printf 'length 1\nelements 10\nstation 0\nstiffness 1e6 0 0 1 1 1\nmass 1\n' > "$out/column.txt"
{ cat "$out/column.txt"; echo 'load 1 dead -4 0 0'; } > "$out/buckled.txt"
try build/flexbeam exact "$out/buckled.txt"
grep -q '^unstable in  *2 directions' "$out/log" || fail "exact says nothing of a buckled column"
{ printf 'duration 0.01\nstep 0.01\ntrim\nbody b exact\n'; cat "$out/column.txt"; printf 'node 1 tip\nend\nload b.tip dead force -4 0 0\n'; } > "$out/buckled_scene.txt"
build/flexbeam scene "$out/buckled_scene.txt" > "$out/log" 2>&1 || fail "a buckled column does not run: $(cat "$out/log")"
grep -q 'warning: the steady state is unstable, in 2 directions' "$out/log" || fail "scene says nothing of a buckled column: $(cat "$out/log")"

# a line through points of an arc is the arc: the bend of 45 degrees by 9 points, places as fractions
awk 'BEGIN { pi = atan2(0, -1); for (k = 0; k <= 8; k++) { a = pi / 4 * k / 8; printf "point %.15g %.15g 0\n", 100 * (1 - cos(a)), 100 * sin(a) } }' > "$out/points.txt"
sed -e 's/^length .*/length 1/' -e '/^attitude/d' -e '/curvature/d' -e 's/^load [0-9.]*/load 1/' examples/bend45.txt >> "$out/points.txt"
for file in examples/bend45.txt "$out/points.txt"; do
  try build/flexbeam exact $file
  sed -n 's/^tip position//p' "$out/log"
done | awk 'NR == 1 { for (i = 1; i <= 3; i++) x[i] = $i } NR == 2 { for (i = 1; i <= 3; i++) { d = $i - x[i]; if (d * d > 1e-7) exit 1 } seen = 1 } END { exit !seen }' ||
  fail "a line through points of an arc bends otherwise than the arc"
for wrong in "point 0 0 0:the same" "position 1 0 0:follow from the points" "curvature 0 0 1:curvature follows"; do
  { echo "point 0 0 0"; echo "${wrong%%:*}"; sed -n '2,$p' "$out/points.txt"; } | sed '/^ *curvature/{H;d};/^station/{G;}' > "$out/wrong.txt"
  ! build/flexbeam exact "$out/wrong.txt" > /dev/null 2> "$out/log" || fail "taken: $wrong"
  grep -q "${wrong#*:}" "$out/log" || fail "$wrong: $(cat "$out/log")"
done

# 64 bodies, 64 springs: points of mass on a string in gravity swing with omega^2 = x g/l, x the zeros of the Laguerre polynomial of
# degree n, of which the first is (j/r)^2 (1 + (j^2 - 2)/(3 r^4)), J0(j) = 0, r^2 = 4 n + 2; springs k to a wall add k/m
awk 'BEGIN {
  n = 64; m = 0.1; l = 0.05; g = 9.81; k = 1; pi = atan2(0, -1)
  print "gravity 0 -" g " 0\nduration 0.1\ninterval 0.1"
  for (i = 1; i <= n; i++) {
    printf "body b%d rigid\nhub %g  %g 0 0  1e-12 1e-12 1e-12\nnode %g 0 0 tip\nend\n", i, m, l, l
    if (i == 1) printf "joint j1 revolute ground b1\nstart 1 %.17g\nend\n", -pi / 2
    else printf "joint j%d revolute b%d.tip b%d\nend\n", i, i - 1, i
    printf "spring s%d ground b%d.tip\nposition -1 %.15g 0  0 0 0\nlength 1\nstiffness %g\nend\n", i, i, -l * i, k
  }
  j2 = 2.404825557695773 ^ 2; r2 = 4 * n + 2
  printf "output x position b%d.tip x\nmeasure omega frequency 1\nexpect omega %.15g tolerance 1e-7\n", n, sqrt(j2 / r2 * (1 + (j2 - 2) / (3 * r2 * r2)) * g / l + k / m)
}' > "$out/chain.txt"
try build/flexbeam scene "$out/chain.txt"

# known MEASURE VALUE PART SCENE OPTION...: another case of its table, by parameters; a measure differs by that part at most
known() {
  measure=$1 value=$2 part=$3 scene=$4
  shift 4
  build/flexbeam scene "examples/scenes/$scene.txt" "$@" > "$out/log" || true # its own references are missed
  awk -v measure="$measure" -v value="$value" -v part="$part" '$1 == measure && $2 == "=" { met = ($3 / value - 1) ^ 2 <= part ^ 2 }
    END { exit !met }' "$out/log" || fail "$scene $*: $(grep "^$measure =" "$out/log"), expected $value"
}
# [L] table 4.6: six rods
grep '^leigh.*,0.0,\(12.0\|72.0\),' tests/reference/p03_rotating_rod.csv > "$out/rods.csv"
while IFS=, read -r rod hz _ length stretch _; do
  known tip_stretch "$stretch" 5e-4 rotating_rod --set hz="$hz" --set length="$length" \
    --set area="$([ "$rod" = leigh72 ] && echo 6 || echo 2)" --set E="$([ "$rod" = leigh12_elastic ] && echo 1e3 || echo 1e7)"
done < "$out/rods.csv"
# [L] table 4.4, 800 lb in; table 4.7 at rest
known tip_x -1.04092058982688 1e-8 tip_moment --set moment=800
known tip_y 0.2786832000797327 1e-8 tip_moment --set moment=800
known tip_ux -8.5262966926 1e-4 rotating_loaded --set hz=0
known tip_uz 31.597387771 1e-4 rotating_loaded --set hz=0
# [L] 4.9, under a load that is small
known final -0.02435018833890 1e-5 beam_release --set force=1

# modes that are listed are those that are measured; what moves is named
for scene in flap spacecraft whirl; do
  build/flexbeam scene examples/scenes/$scene.txt --modes > "$out/modes.txt" 2> "$out/log" || fail "$scene --modes: $(cat "$out/log")"
  sed -e '/^expect/d; /^measure/d; /^reference/d' examples/scenes/$scene.txt > "$out/measured.txt"
  printf '\nmeasure seventh frequency 7\n' >> "$out/measured.txt"
  try build/flexbeam scene "$out/measured.txt"
  awk -v wanted="$(sed -n 's/^seventh = //p' "$out/log")" '$1 == 7 { off = $4 - wanted; found = off < 1e-5 * wanted && off > -1e-5 * wanted }
    END { exit !found }' "$out/modes.txt" || fail "$scene --modes: mode 7 is not the one measured"
done
# of two equal booms on a hub both move alike, damped by the ratio of the mode
build/flexbeam scene examples/scenes/spacecraft.txt --modes > "$out/modes.txt"
awk '$1 == 7 { ratio = -$6 / (6.283185307 * $2); found = ratio < 1.001 * $5 && ratio > 0.999 * $5 && /left 50 % .q1/ && /right 50 % .q1/ && /bend_z 1/ } END { exit !found }' \
  "$out/modes.txt" && [ "$(grep -c 'rigid-body motion$' "$out/modes.txt")" = 6 ] || fail "spacecraft --modes: $(cat "$out/modes.txt")"
! build/flexbeam scene examples/scenes/flap.txt --modes --out "$out/modes.csv" 2> "$out/log" && grep -q "runs nothing" "$out/log" && [ ! -e "$out/modes.csv" ] ||
  fail "--modes with --out: $(cat "$out/log")"

# [L] 4.11: what its base's acceleration bends an aluminium wing, in closed form; a soft one, by the sum of a cantilever's modes,
# 4 L/b^2 A W^2/(w^2 - W^2) (sin W t - W/w sin w t) with alternating signs, w = b^2 sqrt(EI/(m L^4)); shear takes 0.5 % of w
known bent 1.4431e-4 5e-3 flap --set E=1e7
known bent "$(awk 'BEGIN { split("1.87510406871196 4.69409113297418 7.85475743823761 10.9955407348755", b, " ")
  W = 2 * 3.14159265358979; A = 3.14159265358979 / 180; L = 12
  for (k = 1; k <= 400; k++) {
    bend = 0
    for (r = 1; r <= 4; r++) {
      w = b[r] ^ 2 * sqrt(1e4 / 6 / 5.0724e-4) / L ^ 2
      bend += (r % 2 ? 1 : -1) * 4 * L / b[r] ^ 2 * A * W ^ 2 / (w ^ 2 - W ^ 2) * (sin(W * k * 0.005) - W / w * sin(w * k * 0.005))
    }
    most = bend > most ? bend : most
  }
  printf "%.9g", most }')" 1.5e-2 flap --set swing=1

# the bent column of all other loads of the table, 1 to 160 degrees
grep -v '^#\|^alpha' tests/reference/p06_postbuckling.csv > "$out/bent.csv"
while IFS=, read -r degrees _ load x y; do
  sed -e "s/^expect tip_x .*/expect tip_x $x tolerance 1e-5/" -e "s/^expect tip_y .*/expect tip_y $y tolerance 1e-5/" \
    -e "s|^expect tip_turn .*|expect tip_turn $degrees*3.141592653589793/180 tolerance 1e-5|" examples/scenes/postbuckling.txt > "$out/bent.txt"
  try build/flexbeam scene "$out/bent.txt" --quiet --set p="$load"
  [ ! -s "$out/log" ] || fail "a column bent by $degrees degrees: $(cat "$out/log")"
done < "$out/bent.csv"
known tip_turn 1.0471975511966 1e-6 postbuckling --set nudge=30 # far beyond what it is to lead to

# margins by SciPy of a shaft's loop with other delays, and of a sensor at its far end
while IFS=, read -r case gain reduction phase late radius; do
  case $case in
    disks) set -- delay=0 ;;
    disks_*ms) set -- "delay=$(echo "$case" | sed 's/disks_\(.*\)ms/\1e-3/')" ;;
    far) set -- far=1 --set notch=3.5588 --set depth=0.02 --set lowpass=5 ;;
    *) continue ;;
  esac
  known gain "$gain" 1e-6 shaft_control --set "$@"
  known reduction "$reduction" 1e-6 shaft_control --set "$@"
  known phase "$phase" 1e-6 shaft_control --set "$@"
  known late "$late" 1e-6 shaft_control --set "$@"
  known radius "$radius" 1e-6 shaft_control --set "$@"
done < tests/reference/p13_margins.csv
# the response of a loop over frequency: ascending, |L| in dB and its parts agree, the margin is where it crosses
try build/flexbeam scene examples/scenes/shaft_control.txt --quiet --margins "$out/margins.csv"
awk -F, 'NR == 1 { next } $2 < last || ($5 ^ 2 + $6 ^ 2) / 10 ^ ($3 / 10) - 1 > 1e-9 || 1 - ($5 ^ 2 + $6 ^ 2) / 10 ^ ($3 / 10) > 1e-9 { wrong++ }
  { last = $2 } $3 > 0 { crossing = $4 + 180 } END { exit wrong > 0 || NR < 1000 || (crossing - 70.754) ^ 2 > 0.1 }' "$out/margins.csv" ||
  fail "the response of a loop is not what its margins say"
# the satellite by hybrid coordinates: frequencies, margins and return differences at two angles of its drives, and a pulse
satellite=examples/scenes/satellite.txt
grep '^frequencies' tests/reference/p15_satellite.csv | while IFS=, read -r case values; do
  sed '/^measure/d; /^expect/d' $satellite > "$out/modes.txt"
  for k in $(seq 11 24); do echo "measure f$k frequency $k"; done >> "$out/modes.txt"
  build/flexbeam scene "$out/modes.txt" --set drive="${case#frequencies_}" --set turn=0 > "$out/log" 2>&1 || exit 1
  awk -v values="$values" 'BEGIN { n = split(values, f, ",") } /^f[0-9]+ = / { d = $3 / f[substr($1, 2) - 10] - 1; wrong += !(d * d <= 1e-16); seen++ }
    END { exit !(seen == n && n == 14 && wrong == 0) }' "$out/log" || exit 1
done || fail "frequencies of the satellite: $(grep '^f[12]' "$out/log")"
sed '/^measure/d; /^expect/d' $satellite > "$out/satellite.txt"
for loop in pointing unload; do
  for k in 1 2 3; do
    for kind in gain_margin gain_reduction phase_margin delay_margin; do echo "measure ${loop}_${k}_$kind $kind $loop $k"; done
  done
  echo "measure ${loop}_difference return_difference $loop"
  for kind in gain_margin gain_reduction phase_margin delay_margin; do echo "measure ${loop}_$kind $kind $loop"; done
done >> "$out/satellite.txt"
for drive in 0 0.7; do
  try build/flexbeam scene "$out/satellite.txt" --quiet --set drive=$drive --set turn=0
  build/flexbeam scene "$out/satellite.txt" --set drive=$drive --set turn=0 > "$out/margins.log" 2>&1
  awk -F'[,_.]' -v OFS=, -v drive=$drive '{ text = $0 } sub("^margins_" drive "_", "", text) || sub("^difference_" drive "_", "d:", text) { print text }' tests/reference/p15_satellite.csv > "$out/margins.csv"
  awk -F, 'function off(name, value) { checked++; return !((got[name] - value) ^ 2 <= 1e-12 * value ^ 2) && !(value == 0 && got[name] == 0) }
    NR == FNR { split($0, w, " = "); got[w[1]] = w[2]; next }
    /^d:/ { wrong += off(substr($1, 3) "_difference", $2); next }
    { split($1, w, "."); name = w[1]; at = name "_" w[2]
      split("gain_margin gain_reduction phase_margin delay_margin", kind, " ")
      for (k = 1; k <= 4; k++) {
        wrong += off(at "_" kind[k], $(k + 1))
        worst[name, k] = w[2] == 1 || (k == 2 ? $(k + 1) > worst[name, k] : $(k + 1) < worst[name, k]) ? $(k + 1) : worst[name, k]
        if (w[2] == 3) wrong += off(name "_" kind[k], worst[name, k])
      } }
    END { exit !(checked == 34 && wrong == 0) }' "$out/margins.log" "$out/margins.csv" || fail "margins of the satellite at $drive: $(cat "$out/margins.log")"
  sed -e '/^control/,/^end/d; /^output .* command/d; /^output .* allocated/d; /^parameter turn/d; /^parameter loop/d; /^measure/d; /^expect/d' -e 's/^step .*/step 0.002/; s/^duration .*/duration 8/' $satellite > "$out/pulse.txt"
  try build/flexbeam scene "$out/pulse.txt" --quiet --set drive=$drive --set push=1e-5 --out "$out/pulse.csv"
  awk -F, -v drive=$drive 'NR == FNR { split($1, w, "_"); if (w[1] == "pulse" && w[2] == drive) { tip[w[3] + 0] = $2; rate[w[3] + 0] = $3 } next }
    FNR == 1 { for (i = 1; i <= NF; i++) { if ($i ~ /^tip /) T = i; if ($i ~ /^rate_x /) R = i } next }
    ($1 in tip) { seen++; wrong += !(($T / 1e-5 - tip[$1]) ^ 2 < (3.2e-3 * 1e-6) ^ 2) + !(($R / 1e-5 - rate[$1]) ^ 2 < (1.1e-3 * 2e-6) ^ 2) }
    END { exit !(seen == 3 && wrong == 0) }' tests/reference/p15_satellite.csv "$out/pulse.csv" || fail "the satellite after a pulse, drives at $drive"
done
# a satellite turned by a controller, and the same as a program
try ${CC:-cc} $c99 -O1 -o "$out/program" tests/checks/satellite.c build/library/double.o -lm
"$out/program" > "$out/program.csv" || fail "the satellite as a program: $(tail -n 1 "$out/program.csv")"
{
  cat examples/scenes/satellite_control.txt
  for column in turn rate bend wheel torque; do
    echo "reference program.csv t $column output $column tolerance 1e-9 relative"
  done
} > "$out/program.txt"
try build/flexbeam scene "$out/program.txt" --quiet
[ ! -s "$out/log" ] || fail "the satellite as a scene: $(cat "$out/log")"

# hub and booms as one body, in place of bodies on rigid joints
sed 's/^  damping 0.003$//' examples/two_booms.txt > "$out/two_booms.txt"
sed -e 's|\.\./two_booms|two_booms|' -e 's/craft\.wheel wheel/craft wheel/' examples/scenes/two_booms.txt > "$out/one_body.txt"
for column in turn rate bend wheel; do
  echo "reference satellite_control.csv t $column output $column tolerance 1e-9 relative" >> "$out/one_body.txt"
done
try build/flexbeam scene "$out/one_body.txt" --quiet
[ ! -s "$out/log" ] || fail "the satellite as one body: $(cat "$out/log")"

# rotors of a description, driven and read by name, are those of a scene
{
  printf 'duration 5\ninterval 0.1\nstep 0.01\n'
  echo "body craft file $(pwd)/examples/satellite_wheels.txt"
  printf 'end\nrotor craft.yaw\n  motor smooth 0.1 0 1\nend\nrotor craft.roll\n  speed 50\nend\n'
} > "$out/inside.txt"
{
  printf 'duration 5\ninterval 0.1\nstep 0.01\nbody craft parts\n'
  sed -e '1,/^parts/d' -e '/^rotor/,/^end/d' examples/satellite_wheels.txt
  printf 'end\n'
  sed -n -e 's/^rotor \([a-z]*\) bench/rotor \1 craft.bench/' -e '/^rotor/,/^end/p' examples/satellite_wheels.txt |
    sed -e '/^rotor yaw/a motor smooth 0.1 0 1' -e '/^rotor roll/a speed 50'
} > "$out/outside.txt"
for file in inside outside; do
  dot=$([ $file = inside ] && echo craft. || true)
  {
    printf 'output w spin craft\noutput tip displacement craft.tip\noutput s rotor_speed %syaw\n' "$dot"
    printf 'output h rotor_momentum %spitch\ncontrol c\n  sample 0.1\n  input h\n  reference constant 32\n' "$dot"
    printf '  pid 0.1 0 0\n  output rotor %spitch\nend\n' "$dot"
  } >> "$out/$file.txt"
  try build/flexbeam scene "$out/$file.txt" --quiet --out "$out/$file.csv"
done
[ "$(wc -l < "$out/inside.csv")" -gt 50 ] && cmp -s "$out/inside.csv" "$out/outside.csv" || fail "rotors of a description move otherwise than those of a scene"

# what is like another thing is what it would be written out, to the last bit; nodes of a part are called by its name and
# theirs. satellite_turn.txt is the satellite with parts and rotors like others
awk '/^  beam left like/ { print "  beam left\n    position -0.5 0 0\n    attitude z 180\n" boom "  end"; next }
  /^rotor [a-z]* like/ { print "rotor " $2 " craft\n  axis " $5 " " $6 " " $7 "\n  inertia 0.05\nend"; next }
  /^    (length|stations|  0 |end|modes|node)/ { line = $0; sub(/tip tip/, "tip left_tip", line); boom = boom line "\n" }
  /^  damping/ { print "  effects full damping" }
  { sub(/craft\.left\.tip/, "craft.left_tip"); print }' examples/scenes/satellite_turn.txt > "$out/written.txt"
! grep -q like "$out/written.txt" || fail "not all of it is written out: $(cat "$out/written.txt")"
try build/flexbeam scene "$out/written.txt" --quiet --out "$out/written.csv"
[ "$(wc -l < "$out/written.csv")" -gt 50 ] && cmp -s "$out/written.csv" "$out/satellite_turn.csv" || fail "a satellite of equal parts moves otherwise than written out"
[ "$(grep -c . examples/scenes/satellite_turn.txt)" -le 40 ] || fail "the satellite takes more than 40 lines"
awk '/^body left like/ { printf "body left beam\n%s", boom; next } /^body right/ { within = 1 } { print } within && !/^body/ { boom = boom $0 "\n" }
  /^end/ { within = 0 }' examples/scenes/satellite_control.txt > "$out/written.txt"
try build/flexbeam scene "$out/written.txt" --quiet --out "$out/written.csv"
cmp -s "$out/written.csv" "$out/satellite_control.csv" || fail "a body like another one moves otherwise"
{
  printf 'duration 2\nstep 0.01\ninterval 0.1\nbody a parts\n  hub 100  0 0 0  9 9 9\n  rotor w\n    axis 0 0 1\n    inertia 0.1\n    speed 9\n  end\n'
  printf '  component panel\n    position 1 0 0\n    modes 1\n    frequency_hz 0.5\n    node 1  1 0 0  2\n    node 2  2 0 0  2\n'
  printf '    shape 1 1  0 0.1 0 0 0 0.2\n    shape 1 2  0 0.4 0 0 0 0.3\n    line straight frame 0 0 0 1 2\n    mark 2 end\n  end\n'
  printf '  component other like panel  -1 0 0  z 180\nend\nbody b like a\nload a.other.end dead force 0 1 0\nload b.panel dead torque 0 0 1\n'
} > "$out/copies.txt"
refused_copies() {
  ! build/flexbeam scene "$out/copies.txt" --quiet > "$out/log" 2>&1 && grep -q "$1" "$out/log" || fail "not '$1' but $(cat "$out/log")"
}
refused_copies "body b has no node panel"
sed -i -e 's/load b.panel/load b.other.end/' -e '$a output y displacement a.other.end y\noutput z displacement b.end y\noutput s rotor_speed a.w\noutput w rotor_speed b.w' "$out/copies.txt"
sed -i 's/load b.other.end dead torque 0 0 1/load b.end dead force 0 -1 0/' "$out/copies.txt"
try build/flexbeam scene "$out/copies.txt" --quiet --out "$out/copies.csv"
awk -F, 'NR > 1 { n++; wrong += ($2 + $3) ^ 2 > 1e-20 || ($4 - $5) ^ 2 > 1e-20; moved += $2 ^ 2 > 1e-12 } END { exit !(n == 21 && wrong == 0 && moved == 20) }' \
  "$out/copies.csv" || fail "equal bodies under opposite loads move otherwise: $(head -3 "$out/copies.csv")"

# warned SCENE TEXT: it runs, with that warning
warned() {
  try build/flexbeam scene "$1" --quiet
  grep -q "$2" "$out/log" || fail "no warning '$2' but $(cat "$out/log")"
}
sed 's/^  damping 0.005/  damping 5/' examples/scenes/satellite_turn.txt | sed '/^expect/d' > "$out/damped.txt"
warned "$out/damped.txt" "warning: body craft: line 9: a damping ratio of 5: such a mode does not swing"
sed -e '/^expect/d' -e '/^reference/d' -e 's/^parameter spin 6/parameter spin 14/' examples/scenes/spinup_rate.txt > "$out/bent.txt"
warned "$out/bent.txt" "warning: body beam bends by up to 11 % of its size: displacements of modes err by up to 1 % at 6 %, several percent from 15 % on"
sed -e 's/node 2  2 0 0  2/node 2  0.3 0 0  2/' "$out/copies.txt" > "$out/folded.txt"
warned "$out/folded.txt" "warning: body a: line 19: at node 1 a line turns back by more than 90 degrees"

sed -e '/^step/d' -e '/^body craft/a auto 0.01' "$out/inside.txt" > "$out/chosen.txt"
for axis in y z; do
  echo "reference inside.csv t tip_$axis output tip_$axis tolerance 0.01 relative" >> "$out/chosen.txt"
done
try build/flexbeam scene "$out/chosen.txt" --quiet
[ ! -s "$out/log" ] || fail "a satellite with wheels, modes and step chosen: $(cat "$out/log")"

# a start that a loop moves is told
sed 's/start 1 0.7$/start 1 0.6/' examples/scenes/four_bar.txt | grep -v '^duration\|^reference' > "$out/moved.txt"
printf 'duration 0.01\n' >> "$out/moved.txt"
build/flexbeam scene "$out/moved.txt" > "$out/log" 2>&1 || true
told='joint [a-z]* starts at .* instead of .*, where its loop is closed'
grep -q "$told" "$out/log" || fail "nothing is said of joints that a loop moves"
sed -i '/rate 1/d; /^parameter rate/d; /^output\|^measure\|^expect/d' "$out/moved.txt"
try build/flexbeam scene "$out/moved.txt" --code "$out/moved.h"
grep -q "$told" "$out/log" || fail "--code: nothing is said of joints that a loop moves"
# a speed, too: the coupler does not turn where crank and rocker are upright, the rocker turns by 2 0.3/0.5 rad/s
printf 'duration 0.01\nbody crank rigid\n  hub 1  0 0 0  1 1 1\n  node 0.3 0 0 pin\nend\nbody coupler rigid\n  hub 1  0 0 0  1 1 1\n  node 0.7 0 0 pin\n' > "$out/hasty.txt"
printf 'end\nbody rocker rigid\n  hub 1  0 0 0  1 1 1\n  node 0.5 0 0 pin\nend\njoint shaft revolute ground crank\n  start 1 1.5707963267948966 2\n' >> "$out/hasty.txt"
printf 'end\njoint pin revolute crank.pin coupler\n  start 1 -1.5707963267948966 -2\nend\njoint pivot revolute ground rocker\n' >> "$out/hasty.txt"
printf '  position 0.7 -0.2 0\n  start 1 1.5707963267948966 1.2\nend\nloop knee revolute coupler.pin rocker.pin\nend\n' >> "$out/hasty.txt"
told='joint [a-z]* starts at .* rad/s instead of .* rad/s, where its loop is closed'
try build/flexbeam scene "$out/hasty.txt"
! grep -q 'where its loop is closed' "$out/log" || fail "speeds of the linkage are told of: $(cat "$out/log")"
sed -i 's/^  start 1 1.5707963267948966 2/  start 1 1.5707963267948966 3/' "$out/hasty.txt"
try build/flexbeam scene "$out/hasty.txt"
grep -q "$told" "$out/log" || fail "nothing is said of speeds that a loop changes"

# modes that a loop moves at the start are told, too, and not where joints have the speeds of the linkage, by closed form:
# crank and coupler in line at 0 and pi, rocker upright
printf 'duration 0.01\nbody crank rigid\n  hub 1  0 0 0  1 1 1\n  node 0.3 0 0 pin\nend\nbody coupler beam\n  length 0.7\n  elements 4\n' > "$out/bent.txt"
printf '  stations x mass EI_y EI_z\n    0 1 90 90\n  end\n  load 4 y\n  modes bend_y 1\n  node tip pin\nend\nbody rocker rigid\n  hub 1  0 0 0  1 1 1\n' >> "$out/bent.txt"
printf '  node 0.5 0 0 pin\nend\njoint shaft revolute ground crank\n  start 1 1.5707963267948966 2\nend\njoint pin revolute crank.pin coupler\n' >> "$out/bent.txt"
printf '  start 1 -1.5707963267948966\nend\njoint pivot revolute ground rocker\n  position 0.7 -0.2 0\n  start 1 1.5707963267948966\nend\n' >> "$out/bent.txt"
printf 'loop knee revolute coupler.pin rocker.pin\nend\n' >> "$out/bent.txt"
told='body coupler starts with modes that move'
try build/flexbeam scene "$out/bent.txt"
grep -q "$told" "$out/log" || fail "nothing is said of modes that a loop moves"
sed -i -e '/^  start 1 -1.57/s/$/ -2/' -e '/^joint pivot/,/^end/s/^  start .*/& 1.2/' "$out/bent.txt" # coupler does not turn: 2 0.3/0.5
try build/flexbeam scene "$out/bent.txt"
! grep -q "$told" "$out/log" || fail "the speeds of a linkage: $(cat "$out/log")"

# a slack line by the elastic catenary (58317.39 N across, 61750.28 N down at its anchor); a mesh too coarse for its EI says so
slack() {
  printf 'length 220\nelements 80\nstation 0\nstiffness 6e7 0 0 1e4 %s %s\nmass 95\ngravity 0 0 -9.81\n' "$1" "$1" > "$out/slack.txt"
  printf 'root x y z rx\ntip x y z\nmove tip -60 0 75\n' >> "$out/slack.txt"
  build/flexbeam exact "$out/slack.txt" > "$out/log" 2>&1 || true
}
slack 2e5
awk '/^force on the root/ { off = sqrt($6 * $6 + $8 * $8) / 84937.0 - 1; if (off < 0) off = -off; if (off < 1e-3) found = 1 } END { exit !found }' "$out/log" ||
  fail "a slack line: $(cat "$out/log")"
! grep -q 'unstable in' "$out/log" || fail "a slack line is unstable: $(cat "$out/log")"
slack 2e4
grep -q 'unstable in.*wrong, as element .* bears 12 EI/h^2 = 3.174e+04: more elements' "$out/log" ||
  fail "a mesh too coarse for a slack line: $(cat "$out/log")"
slack 2e2
grep -q 'a tension of 12 EI/h^2 = 317.4' "$out/log" || fail "a slack line without much EI: $(cat "$out/log")"

# a table of a spreadsheet: byte order mark, quotes, semicolons
printf '\357\273\277"t [s]"; "x"\r\n0;3\r\n"1" ; 3\r\n' > "$out/table.csv"
printf 'duration 1\nbody b rigid\n  hub 1  0 0 0  1 1 1\nend\nload b dead force 1 0 0 file table.csv t x\n' > "$out/table.txt"
printf 'output v velocity b x\nmeasure v final v\nexpect v 3 tolerance 1e-9\n' >> "$out/table.txt"
try build/flexbeam scene "$out/table.txt"
grep -q 'v = 3' "$out/log" || fail "a table with quotes and semicolons is not read"

printf 't,"pos, x",x\n0,7,3\n1,7,3\n' > "$out/table.csv"
try build/flexbeam scene "$out/table.txt"
printf '"t";"pos, x";x\n0;7;3\n1;7;3\n' > "$out/table.csv"
try build/flexbeam scene "$out/table.txt"

# a frame that an earlier run left; files that are one another or the scene, or that cannot be written: told before the run
touch "$out/frames/frame_0007.svg"
try build/flexbeam scene examples/scenes/double_pendulum.txt --quiet --frames "$out/frames" --frame-count 4
[ "$(ls "$out/frames")" = "$(printf 'frame_000%d.svg\n' 1 2 3 4)" ] || fail "frames of an earlier run are left"
printf 'duration 1e9\ninterval 1e3\nstep 1e-4\nbody b rigid\n  hub 1 0 0 0 1 1 1\nend\n' > "$out/long.txt"
cp "$out/long.txt" "$out/kept.txt"
# collides REASON OPTION...
collides() {
  reason=$1
  shift
  status=0
  timeout 20 build/flexbeam scene "$out/long.txt" "$@" > "$out/log" 2>&1 || status=$?
  [ $status = 2 ] && grep -q -F -e "$reason" "$out/log" || {
    cat "$out/log"
    fail "$*: status $status, expected: $reason"
  }
  cmp -s "$out/long.txt" "$out/kept.txt" && [ ! -e "$out/c.csv" ] && [ ! -e "$out/c.svg" ] || fail "$*: a file was touched"
}
collides "--out: that is the scene itself" --out "$out/long.txt"
collides "--picture: that is the scene itself" --picture "$out/../$name/long.txt"
cp "$out/table.csv" "$out/table_kept.csv"
printf 'load b dead force 1 0 0 file table.csv t x\n' >> "$out/long.txt"
cp "$out/long.txt" "$out/kept.txt"
collides "--out: that is the scene itself, or what it reads" --out "$out/table.csv"
cmp "$out/table.csv" "$out/table_kept.csv" || fail "a table that the scene reads was written over"
collides "--margins: that is the scene itself" --margins "$out/long.txt"
collides "--code: that is the scene itself" --code "$out/long.txt"
collides "--jacobian: that is the scene itself" --jacobian "$out/long.txt"
collides "curves of --margins and --picture are the same file" --margins "$out/c.csv" --picture "$out/c.svg"
collides "margins: the scene has no controller" --margins "$out/c.csv"
collides "curves of --out and --picture are the same file" --out "$out/c.csv" --picture "$out/c.svg"
collides "--out and curves of --out are the same file" --out "$out/c.svg"
collides "--picture and --animation are the same file" --picture "$out/c.svg" --animation "$out/./c.svg"
collides "--out: No such file or directory" --out "$out/nowhere/c.csv"
collides "--animation: Is a directory" --animation "$out"
collides "cannot make the folder" --frames "$out/long.txt/frames"
collides "a whole number is wanted: --frame-count" --frame-count 2.5

# interrupted: the rows so far are there under another name, and what an earlier run wrote is as it was
echo "of an earlier run" > "$out/rows.csv"
sed "s/^duration.*/duration 1e7/; s/^interval.*/interval 1/; s/^step.*/step 0.1/" "$out/kept.txt" > "$out/rows.txt"
build/flexbeam scene "$out/rows.txt" --quiet --out "$out/rows.csv" &
running=$!
for wait in $(seq 500); do
  [ ! -s "$out/rows.csv.part" ] || break
  sleep 0.02
done
so_far=$(wc -c < "$out/rows.csv.part")
status=0
timeout 20 build/flexbeam scene examples/scenes/top.txt --quiet --out "$out/rows.csv" > "$out/log" 2>&1 || status=$?
[ $status = 2 ] && grep -q "scene: --out: another run is writing it: .*/rows.csv" "$out/log" ||
  fail "two runs into one file: status $status, $(cat "$out/log")"
[ "$(wc -c < "$out/rows.csv.part")" -ge "$so_far" ] && head -n 1 "$out/rows.csv.part" | grep -q '^t \[s\]' ||
  fail "a second run has written over the rows of the first"
kill -9 $running
wait $running 2> /dev/null || true
[ -s "$out/rows.csv.part" ] && [ "$(cat "$out/rows.csv")" = "of an earlier run" ] || fail "rows of an interrupted run look whole"
sed -i "s/^interval.*/interval 1e5/" "$out/rows.txt" # seconds for each 4096 characters: they do not wait for that many
rm "$out/rows.csv.part"
status=0
timeout --preserve-status 10 build/flexbeam scene "$out/rows.txt" --quiet --out "$out/rows.csv" 2> "$out/log" || status=$?
[ "$(wc -l < "$out/rows.csv.part")" -gt 1 ] || fail "rows of a slow run are not in their file"
[ $status = 143 ] && grep -q "stopped after the row of $(tail -n 1 "$out/rows.csv.part" | cut -d , -f 1) s, of 10000000 s; .* is $out/rows.csv.part\$" "$out/log" ||
  fail "a run that is terminated: status $status, $(cat "$out/log"), $(tail -n 1 "$out/rows.csv.part")"
try build/flexbeam scene examples/scenes/top.txt --quiet --out "$out/rows.csv"
[ ! -e "$out/rows.csv.part" ] && cmp -s "$out/rows.csv" "$out/top.csv" || fail "rows do not get their name when the run has ended"
collides "--out until the run ends and --picture are the same file" --out "$out/c.csv" --picture "$out/c.csv.part"

# what is no plain file is written as it is: a link stays one, /dev/stdout too, and who reads a pipe gets all of it
echo "of an earlier run" > "$out/behind.csv"
ln -s behind.csv "$out/link.csv"
ln -s not_yet.csv "$out/dangling.csv"
ln -s /proc/self/fd/1 "$out/stdout.csv"
mkfifo "$out/pipe.csv"
try build/flexbeam scene examples/scenes/top.txt --out "$out/link.csv"
try build/flexbeam scene examples/scenes/top.txt --out "$out/dangling.csv"
build/flexbeam scene examples/scenes/top.txt --quiet --out "$out/stdout.csv" > "$out/redirected.csv"
timeout 60 cat "$out/pipe.csv" > "$out/piped.csv" &
timeout 60 build/flexbeam scene examples/scenes/top.txt --out "$out/pipe.csv" > "$out/log" 2>&1 || fail "no run into a pipe: $(cat "$out/log")"
wait
for file in behind not_yet redirected piped; do
  cmp "$out/$file.csv" "$out/top.csv" || fail "$file.csv has not the rows"
done
for file in link dangling stdout; do
  [ -L "$out/$file.csv" ] || fail "the link $file.csv is replaced by a file"
done

# the step that is told is the one of a drive that is faster than the modes: 0.3 rad of 100 Hz; one that is given is cut by rows
printf 'duration 1\ninterval 0.1\nbody b rigid\n  hub 1  0 0 0  1 1 1\nend\nload b dead force 1 0 0 sine 1 100\n' > "$out/sine.txt"
try build/flexbeam scene "$out/sine.txt"
awk '/step at most/ { told = $6; steps = $8 } END { exit !(told > 0 && told <= 4.78e-4 && steps >= 2095 && steps < 3000) }' "$out/log" ||
  fail "another step is told: $(cat "$out/log")"
sed -i 's/^interval.*/interval 0.001\nstep 0.05/' "$out/sine.txt"
try build/flexbeam scene "$out/sine.txt"
! grep -q warning "$out/log" || fail "warned of steps that rows shorten: $(cat "$out/log")"

# the step that is chosen resolves what each output sees: a star tracker on a mast of 17.5 rad/s beside a boom of 1.2 rad/s; a
# step that does not is told of, with its error, and of no other output; one that does is not
sed '/^expect/d' examples/scenes/star_tracker.txt > "$out/tracker.txt"
sed '$a step 0.0005' "$out/tracker.txt" > "$out/tracker_fine.txt"
try build/flexbeam scene "$out/tracker_fine.txt" --quiet --out "$out/tracker_fine.csv"
[ ! -s "$out/log" ] || fail "a star tracker in short steps: $(cat "$out/log")"
for step in auto 0.005 0.02; do
  error=$(case $step in auto) echo 0.002 ;; 0.005) echo 0.001 ;; 0.02) echo 0.1 ;; esac)
  {
    cat "$out/tracker.txt"
    echo "step $step"
    echo "reference tracker_fine.csv t tracker output tracker tolerance $error relative"
    echo "reference tracker_fine.csv t tip output tip tolerance 0.002 relative"
    echo "reference tracker_fine.csv t turned output turned tolerance 0.002 relative"
  } > "$out/tracker_step.txt"
  try build/flexbeam scene "$out/tracker_step.txt"
  grep 'is not resolved' "$out/log" > "$out/told" || true
  if [ $step = 0.02 ]; then
    [ "$(wc -l < "$out/told")" = 1 ] && grep -q 'output tracker is not resolved: steps of 0.0192 s .* mode 15 of 17\.[0-9]* rad/s, of body craft' "$out/told" ||
      fail "what steps of 0.02 s do not resolve is not told: $(cat "$out/log")"
    # tracker: DIFFERENCE at most from .. of which the largest is SIZE; the range is twice that
    awk '/is not resolved/ { for (i = 1; i < NF; i++) if ($(i + 1) == "%") told = $i / 100 }
      $1 == "tracker:" { for (i = 1; i < NF; i++) if ($i == "largest") met = $2 / $(i + 2) / 2 }
      END { exit !(told > 0 && told < 1.5 * met && met < 1.5 * told) }' "$out/log" || fail "another error is told: $(cat "$out/log")"
  else
    [ ! -s "$out/told" ] || fail "a star tracker in steps of $step: $(cat "$out/told")"
  fi
done

# a moored body that falls from a tilt and spins: modes of the start grow by e^6 within the run, the motion does not. In steps of
# 5 ms it is resolved, nothing is said; in those of 10 ms errors are told in the size that they have, not as 100 %
cat > "$out/moored.txt" << END
duration 20
interval 0.05
gravity 0 0 -9.81
body hull rigid
  hub 5  0 0 0.1  0.7 0.9 1.3
  start_position 0.1 0.1 0.1
  start_attitude x 60
  start_spin 0 0 3
end
joint moorings free ground hull
  stiffness 40 55 90  30 36 20
  damping 0.3 0.2 0.1  0.5 0.6 0.7
end
output place position hull x
END
try build/flexbeam scene "$out/moored.txt" --quiet --out "$out/moored_fine.csv"
printf 'integrator sdirk\nstep 0.005\nreference moored_fine.csv t place output place tolerance 0.002 relative\n' >> "$out/moored.txt"
try build/flexbeam scene "$out/moored.txt" --quiet
[ ! -s "$out/log" ] || fail "a moored body in short steps: $(cat "$out/log")"
sed -i 's/^step .*/step 0.01/; /^reference/d' "$out/moored.txt"
try build/flexbeam scene "$out/moored.txt" --quiet
grep -q 'place is not resolved: steps of 0.01 s err by some [1-3][.0-9]* %' "$out/log" || fail "a moored body in steps of 10 ms: $(cat "$out/log")"

# after a second a long run tells how long it takes, and of which body its steps are so short; with --quiet nothing
printf 'duration 10\nintegrator rk4\nbody rod beam\n length 1\n hub 1  0 0 0  1 1 1\n start_spin 0 0 1\n modes bend_z 2\n stations x mass EI_y\n  0 1 1e14\n end\nend\n' \
  > "$out/long.txt"
build/flexbeam scene "$out/long.txt" > "$out/log" 2>&1 &
run=$!
build/flexbeam scene "$out/long.txt" --quiet > "$out/quiet" 2>&1 &
quiet=$!
for second in $(seq 60); do
  ! grep -q 'the others will take' "$out/log" || break
  sleep 1
done
sleep 2
kill $run $quiet
wait $run $quiet || true
grep -q '^integrator rk4, step at most .* s, [0-9]* steps$' "$out/log" || fail "a long run does not say its steps: $(cat "$out/log")"
grep -q 'steps; the first .* will take some [0-9.]* [a-z]*; the modes of body rod want such short steps' "$out/log" ||
  fail "a long run does not say how long: $(cat "$out/log")"
[ ! -s "$out/quiet" ] || fail "a long run with --quiet says: $(cat "$out/quiet")"
sed 's/1e14/1e19/' "$out/long.txt" > "$out/longer.txt"
! build/flexbeam scene "$out/longer.txt" --quiet > "$out/log" 2>&1 || fail "1e11 steps are taken"
grep -q '1e+10 at most; the modes of body rod want such short steps' "$out/log" || fail "the body of short steps is not named: $(cat "$out/log")"

# a disk that is full: told, at the first row that does not fit and at the last one
for run in '1e7 1 0.1' '1 1 1'; do
  set -- $run
  sed "s/^duration.*/duration $1/; s/^interval.*/interval $2/; s/^step.*/step $3/" "$out/kept.txt" > "$out/full.txt"
  status=0
  timeout 20 build/flexbeam scene "$out/full.txt" --quiet --out /dev/full > "$out/log" 2>&1 || status=$?
  [ $status = 1 ] && grep -q 'cannot write /dev/full: No space left' "$out/log" || fail "a full disk: status $status, $(cat "$out/log")"
done

try ${CC:-cc} $c99 -O0 -g -fsanitize=address,undefined -fno-sanitize-recover -o "$out/careful" -Dscene_main=main examples/scene/scene.c examples/tools/trace/untraced.c examples/tools/library.c -lm
# meets < FILE: it runs, and its answers are those that it expects
met=0
meets() {
  cat > "$out/good.txt"
  "$out/careful" "$out/good.txt" --quiet > "$out/log" 2>&1 || {
    cat "$out/good.txt" "$out/log"
    fail "a closed form is missed"
  }
  met=$((met + 1))
}
. tests/checks/scene_meets.sh
refused=0
# refuse LINE REASON < FILE: line 0: the file as a whole
refuse() {
  { grep -v '^$' || true; } > "$out/bad.txt"
  status=0
  "$out/careful" "$out/bad.txt" --quiet > "$out/log" 2>&1 || status=$?
  line=$([ "$1" = 0 ] || echo ":$1")
  [ $status = 2 ] && [ "$(wc -l < "$out/log")" = 1 ] && grep -q -F "bad.txt$line: $2" "$out/log" || {
    cat "$out/bad.txt" "$out/log"
    fail "status $status, expected line $1: $2"
  }
  refused=$((refused + 1))
}
# fails REASON [LINE] < FILE: it is read, but does not run
fails() {
  cat > "$out/bad.txt"
  status=0
  "$out/careful" "$out/bad.txt" --quiet > "$out/log" 2>&1 || status=$?
  [ $status = 1 ] && grep -q -F "bad.txt${2:+:$2}: $1" "$out/log" || {
    cat "$out/log"
    fail "status $status, expected: $1"
  }
  refused=$((refused + 1))
}
# warned REASON STATUS < FILE: it runs, with this said
warned() {
  cat > "$out/bad.txt"
  status=0
  "$out/careful" "$out/bad.txt" --quiet > "$out/log" 2>&1 || status=$?
  [ $status = "$2" ] && grep -q "bad.txt: .*$1" "$out/log" || {
    cat "$out/log"
    fail "status $status, expected: $1"
  }
}
top='body top rigid
  hub 1  0 0 0  1 2 3
  node 0 0 1 tip
end'
beam='body beam beam
  length 10
  stations x mass EI_z
    0 1.2 14004
  end
  modes bend_y 2
  base prescribed
  node tip tip
end'
. tests/checks/scene_refused.sh
ok "$scenes scenes meet their references, $met small ones closed forms; the same bits again; $refused malformed files refused"
