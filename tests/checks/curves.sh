#!/bin/sh
# Curves of scenes and of their loops, as far as text says it: a panel for each unit and size, every name in a key, ticks of
# an axis that differ, margins named and marked, a Nyquist curve without corners.
. tests/checks/common.sh
command -v gnuplot > /dev/null || skip "gnuplot is not installed"

# curves SCENE PANELS: the picture of the rows has so many, and the names of all columns
curves() {
  try build/flexbeam scene "$1" --out "$out/rows.csv"
  panels=$(grep -c '<text>\[.*\]</text>' "$out/rows.svg") || true
  [ "$panels" = "$2" ] || fail "$1: $panels panels, not $2"
  for label in $(sed -n '1{ s/^t [^,]*,//; s/ \[[^]]*\]//g; s/,/ /g; p; }' "$out/rows.csv"); do
    grep -q "<text>$label</text>" "$out/rows.svg" || fail "$1: the key has no $label"
  done
  [ "$(grep -c "time \[s\]" "$out/rows.svg")" = 1 ] || fail "$1: not one axis says what it is"
  differ "$1" "$out/rows.svg"
}

# differ WHAT SVG: no tick says what the one before says, and all say a number
differ() {
  sed -n 's/.*<text><tspan[^>]*>\([^a-z]*[0-9][^<]*\)<.*/\1/p' "$2" > "$out/ticks"
  awk '$0 == last || $0 !~ /^-?[0-9.]+(e[-+][0-9]+)?$/ { wrong = 1 } { last = $0 } END { exit wrong || NR < 6 }' "$out/ticks" ||
    fail "$1: ticks are the same, or no numbers"
}

# wheels PANELS SPEED...: a body with wheels of these speeds
wheels() {
  panels=$1
  shift
  {
    printf 'duration 1\ninterval 0.1\nbody hub rigid\nhub 50 0 0 0 2 3 4.5\nend\n'
    k=0
    for speed; do
      k=$((k + 1))
      printf 'rotor w%d hub\naxis 0 1 0\ninertia 1e-4\nspeed %s\nend\n' $k "$speed"
    done
    k=0
    for speed; do
      k=$((k + 1))
      printf 'output a_rather_long_name_of_a_wheel_%d rotor_speed w%d\n' $k $k
    done
  } > "$out/wheels.txt"
  curves "$out/wheels.txt" "$panels"
}

curves examples/scenes/satellite_control.txt 6 # the gyro beside the wheel, both [rad/s]
curves examples/scenes/momentum_wheel.txt 3
curves examples/scenes/four_bar.txt 4
curves examples/scenes/large_whirl.txt 1
wheels 2 100 30 1 # 30 is within a thirtieth of 100, 1 is not
wheels 2 1e6 1e-9
wheels 1 0 0
wheels 1 100000.5

# marks SCENE TEXT...: the loop of its controller is drawn, with a line of the key for each margin
marks() {
  file=$1
  shift
  try build/flexbeam scene "examples/scenes/$file.txt" --margins "$out/loop.csv"
  for text; do
    grep -q "<text>$text</text>" "$out/loop.svg" || fail "$file: the picture does not say $text"
  done
  differ "$file" "$out/loop.svg"
  awk -F, 'NR > 2 { one = sqrt(re ^ 2 + im ^ 2); if (sqrt(($5 - re) ^ 2 + ($6 - im) ^ 2) > 0.0501 * (one > 1 ? one : 1)) exit 1 }
    { re = $5; im = $6 }' "$out/loop.csv" || fail "$file: the Nyquist curve has corners"
}
marks shaft_control "gain margin 33.4 dB at 16.48 rad/s" "gain reduction -21.8 dB at 0.1649 rad/s" "phase margin 70.8 deg at 1.26 rad/s"
[ "$(grep -c "href='#gpPt[468]'" "$out/loop.svg")" = 11 ] || fail "shaft_control: margins are not marked"
marks satellite_control "gain margin 38.3 dB at 157 rad/s" "phase margin 73.8 deg at 0.7089 rad/s"

ok "8 pictures of rows, 2 of loops"
