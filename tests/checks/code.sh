#!/bin/sh
# The generated step (--code) of the bodies and systems of code.c, each kind that the generator treats on its own: 1,000 steps agree
# with the library's, unloaded and loaded, also at nodes; motion, nodes, energy, refusals and step limits are the library's; variable
# parameters are its fb_body_scale; lanes have the bits of single steps; numbers that are none and flipped bits change nothing, under
# sanitizers; the text compiles without warnings as C99 and C++; instructions keep their bounds and do not vary. So for SDIRK, of joints
# and modes 1,000 times as stiff, and 300 in single precision. Every second of each list each day.
. tests/checks/common.sh
. tests/checks/board.sh
need gcc gcc
need g++ g++
need clang clang
need valgrind valgrind
sizes="-DFB_MAX_LOADS=16 -DFB_MAX_MODES=8 -DFB_MAX_BODIES=8 -DFB_WITH_ANALYSE=0"
try gcc $c99 -include examples/tools/capacities.h -DFLEXBEAM_STATIC -DWRITE -O0 -c -o "$out/write.o" tests/checks/code.c # as the tracer
try g++ -o "$out/write" "$out/write.o" build/tool/trace.o build/tool/trace_single.o -lm
try gcc $c99 $sizes -O0 -c -o "$out/double.o" "$out/impl.c"
try gcc $c99 $sizes -O0 -DFB_SINGLE=1 -c -o "$out/single.o" "$out/impl.c"
sanitize="-O1 -fsanitize=address,undefined -fno-sanitize-recover=all"

# text MODEL [OPTION...]: of --code, with loads at nodes
text() {
  "$out/write" "$@" --loads > "$out/code.h" || fail "$* is not written"
  awk -f tests/checks/code.awk "$out/code.h" > "$out/members.h"
}

gcc=gcc # the compiler of the driver
# against "MODEL [OPTION...]" WHAT [OPTION OF GCC...]: the driver, of which WHAT is the second argument ("": beside the library)
against() {
  model=${1%% *}
  given="$1" what=$2
  shift 2
  text $given
  option=$(echo "$given" | sed -n -e 's/.*--single.*/-DFB_SINGLE=1/p') object=$out/double.o
  [ -z "$option" ] || object=$out/single.o
  case "$given" in *--sdirk*) option="$option -DSDIRK" ;; esac
  try $gcc -O0 $c99 $sizes $option "$@" -I"$out" -o "$out/run" tests/checks/code.c "$object" -lm
  "$out/run" "$model" $what > "$out/log" 2>&1 || {
    head -n 20 "$out/log"
    fail "$given: $what"
  }
  worst=$(sed -n 's/.*worst //p' "$out/log")
}

# larger A: of it and worst
larger() {
  printf '%s\n%s\n' "$1" "$worst" | sort -g | tail -n 1
}

# compile: without warnings everywhere
compile() {
  printf '#define generated_IMPLEMENTATION\n#include "code.h"\nint main(void) { generated_state s; generated_start(&s); return 0; }\n' > "$out/main.c"
  try gcc $c99 -O2 -I"$out" -fsyntax-only "$out/main.c"
  try clang $c99 -O2 -I"$out" -fsyntax-only "$out/main.c"
  try g++ -x c++ -std=c++11 $base -O2 -I"$out" -fsyntax-only "$out/main.c"
  try clang++ -x c++ -std=c++20 $base -O2 -I"$out" -fsyntax-only "$out/main.c"
}

all=stiffness,damping,mass,hub_mass,hub_inertia undamped=stiffness,mass,hub_mass,hub_inertia
number=0 largest=0 models=0
for model in $("$out/write"); do
  number=$((number + 1))
  today $number 2 || continue
  against $model ""
  largest=$(larger $largest) models=$((models + 1))
done
for model in screw "line --vary stiffness,damping" "lines_two --sdirk --lanes"; do
  text $model
  cp "$out/code.h" "$out/first.h"
  text $model
  cmp -s "$out/first.h" "$out/code.h" || fail "$model: the text differs from one run to the next"
done

# variable parameters
varied=0
for each in "craft $all" "linear $all" "pinned $all" "prescribed $all" "hinged $all" "strain $all" "spin $undamped" "rigid hub_mass,hub_inertia" "line stiffness,damping" "falling $all"; do
  number=$((number + 1))
  today $number 2 || continue
  against "${each% *} --vary ${each#* }" ""
  varied=$(larger $varied)
done

single=0
for model in craft pinned prescribed hinged strain wheels falling central line line_prescribed unbalanced "craft --vary $all" screw driven stops loops rotors springs tied axes_ball two_free lines_two lines_spring lines_rotors; do
  number=$((number + 1))
  today $number 2 || continue
  against "$model --single" ""
  single=$(larger $single)
  compile
done

implicit=0 single_implicit=0
for model in hinge booms turned screw ball rotors arm hinged_wheels two_loops loop_tip muscles springs falls_apart axes axes_ball door tied two_free lines_chain lines_two; do
  number=$((number + 1))
  today $number 2 || continue
  against "$model --sdirk" "" -Dgenerated_ITERATIONS=5
  implicit=$(larger $implicit)
  case $model in
  hinge | arm | door | two_free | axes | turned)
    against "$model --sdirk" "" -Dgenerated_ITERATIONS=2
    implicit=$(larger $implicit)
    ;;
  screw | hinged_wheels | muscles | axes_ball | lines_two)
    against "$model --sdirk --single" "" -Dgenerated_ITERATIONS=5
    single_implicit=$(larger $single_implicit)
    compile
    ;;
  esac
done

# lanes by vectors of each length, where this machine has them
avx=$(grep -q avx2 /proc/cpuinfo && echo -mavx2 || true)
for lanes in "craft --vary $all" pinned wheels "prescribed --vary $all" line central screw "ball --sdirk" hinged_wheels driven stops bars loops tied axes "axes_two --sdirk" loop_axes springs moored falls_apart lines_chain lines_rotors two_free "rotors --sdirk" "lines_two --sdirk"; do
  number=$((number + 1))
  today $number 2 || continue
  case $lanes in craft*) level=-O2 ;; *) level=-O0 ;; esac
  against "$lanes --lanes" lanes $level $avx -Dgenerated_LANES=4 -Dgenerated_ITERATIONS=5
  compile
  case $lanes in
  *vary*)
    for width in 1 2 8; do
      against "$lanes --lanes" lanes -O0 -Dgenerated_LANES=$width
    done
    gcc="clang -Wno-pass-failed" # numbers of a model are not aligned
    against "$lanes --lanes" lanes -O1 $avx -Dgenerated_LANES=4
    gcc=gcc
    if command -v arm-none-eabi-gcc > /dev/null; then
      try arm-none-eabi-gcc $c99 -O1 -mcpu=cortex-a9 -mfpu=neon -mfloat-abi=hard -Dgenerated_LANES=4 -I"$out" -c -o "$out/neon.o" "$out/main.c"
    fi
    try gcc $c99 -O1 -mavx512f -Dgenerated_LANES=8 -I"$out" -c -o "$out/wide.o" "$out/main.c"
    ;;
  esac
  case $lanes in central | falls*) ;; *) against "$lanes --lanes --single" lanes $avx -Dgenerated_LANES=8 -Dgenerated_ITERATIONS=5 ;; esac
done

# numbers that are none and flipped bits
attacks=0 steps=0 refused=0
for attack in craft "craft --single" rigid "pinned --vary $all" "prescribed --single --vary $all" wheels "wheels_pinned --single" "line --vary stiffness,damping" "line_prescribed --single" hinge \
  "screw --single" ball "grounded --single" deploys "loops --single" hinged_wheels "rotors_linear --single" driven tips "tip_driven --single" "arm --sdirk" "screw --sdirk" "ball --sdirk --single" \
  "craft --lanes --vary $all" "wheels --lanes --single" "ball --lanes" "loops --lanes --single" "arm --lanes --sdirk"; do
  number=$((number + 1))
  today $number 2 || continue
  against "$attack" hostile $sanitize -Dgenerated_ITERATIONS=3 $(echo "$attack" | sed -n "s/.*--lanes.*/-Dgenerated_LANES=2/p")
  attacks=$((attacks + 1))
  steps=$((steps + $(tail -n 1 "$out/log" | cut -d ' ' -f 1))) refused=$((refused + $(tail -n 1 "$out/log" | cut -d ' ' -f 2)))
done

# bound NUMBER WHAT CALL STATE [SPARE]: steps from that state take at most so many instructions, all the same number but for SPARE: without
# the first step, at angles of zero, whose sines are cheaper
counts=
bound() {
  printf '#define generated_IMPLEMENTATION\n#include "code.h"\nint main(void)\n{\n  generated_state s;\n  generated_start(&s);\n  %s\n  for (int k = 0; k < 50; k++) {\n    if (%s) { return 1; }\n  }\n  return 0;\n}\n' "$4" "$3" > "$out/count.c"
  (ulimit -t ${seconds:-5} && try gcc $c99 -O2 -I"$out" -o "$out/count" "$out/count.c" -lm -Wl,-z,now) || fail "$2: more than ${seconds:-5} s to compile"
  rm -f "$out"/cg*
  try valgrind --tool=callgrind --callgrind-out-file="$out/cg" --toggle-collect=generated_step --dump-after=generated_step "$out/count"
  [ -z "${5:-}" ] || rm "$out/cg.1"
  cat "$out"/cg.* | sed -n 's/^summary: //p' | grep -v '^0$' | sort -n | uniq > "$out/counts"
  count=$(tail -n 1 "$out/counts")
  [ $((count - $(head -n 1 "$out/counts"))) -le ${5:-0} ] || fail "$2: steps differ in their number of instructions: $(tr '\n' ' ' < "$out/counts")"
  [ $count -le $1 ] || fail "$2: $count instructions, more than $1"
  counts="$counts, $count $2"
}

# board BOUND: instructions of a step in single precision on a Cortex-M4F
precision single
configuration="-I$out -O2"
board() {
  cat > "$out/board.c" <<'END'
#define generated_IMPLEMENTATION
#include "code.h"
#include "examples/firmware/board/board.h"
int main(void)
{
  static generated_state s;
  int refused = 0;
  generated_start(&s);
  s.L[2] = s.L[0] = 30;
  s.q[0] = 0.05f;
  for (int k = 0; k < 5; k++) {
    board_count_start();
    refused |= generated_step(&s, 0, 0, 0, 1e-3f) != generated_ok;
    board_print_unsigned(board_count(), 0);
    board_print("\n");
  }
  return refused;
}
END
  image "$out/board.elf" "$out/board.c"
  emulate "$out/board.elf" "$out/counts" || fail "a step on the board is refused"
  count=$(sort -n "$out/counts" | uniq)
  [ "$(echo "$count" | wc -l)" = 1 ] || fail "steps on the board differ in their number of instructions: $count"
  [ $count -le $1 ] || fail "on the board $count instructions, more than $1"
  counts="$counts, $count on the board"
}

# boom MODES FIELD EFFECTS OPTIONS: of each plane, by reduce
boom() {
  printf 'beam\n%s\nhub 500 0 0 0 80 80 80\nbase free\neffects %s\nlength 10\nelements 12\nmodes bend_y %s bend_z %s%s\nstations x mass EI_y EI_z\n0 1.2 14004 14004\nend\n' \
    "$2" "${3% points*}" $1 $1 "${3#"${3% points*}"}" > "$out/boom.txt"
  shift 3
  try build/flexbeam reduce "$out/boom.txt" --name generated --code "$@" --out "$out/code.h"
}
step='generated_step(&s, 0, 0, 0, 1e-3)' stiff='generated_step(&s, 0, 0, 1e-3)'
spun='s.L[2] = s.L[0] = 30; s.q[0] = 0.05;' turns='s.body_0.p[5] = 3; s.body_0.p[3] = 2;' angles='s.body_1.x[0] = 0.3;' waves='s.body_1.x[0] = 0.3; s.body_2.x[0] = 0.2; s.body_1.q[0] = s.body_2.q[1] = 0.01;'
boom 3 "" full
bound 6300 "6 modes" "$step" "$spun"
six=$count
boom 3 "" full --vary $undamped
bound $((six * 112 / 100)) "with parameters" 'generated_step(&m, &s, 0, 0, 0, 1e-3)' "generated_model m; generated_model_init(&m, 0); $spun"
boom 3 "" full --single
board 6800
boom 6 "" full
bound 12000 "12 modes" "$step" "$spun"
boom 6 "" full --single
board 12500
boom 2 "central_gravity 3.986e14 0 0 -7e6" full
bound 9400 "4 modes in gravity of a center" "$step" "$spun"
boom 3 "" "large points 6"
bound 48800 "6 modes and 6 points of a line" "$step" "$spun"
try build/flexbeam reduce examples/satellite_wheels.txt --name generated --code --out "$out/code.h"
bound 7500 "the satellite with three wheels" "$step" 's.L[1] = s.rotor_momentum[0] = 32; s.L[0] = 3; s.q[0] = 0.05;'

# tree BOUND MODEL CALL STATE OPTIONS [SPARE]
tree() {
  "$out/write" $2 $5 > "$out/code.h" || fail "$2 is not written"
  bound $1 "$2${5:+ $5}" "$3" "$4" ${6:-}
}
tree 5000 hinge "$step" "$turns $angles" ""
tree 16000 booms "$step" "$turns $waves" ""
tree 22800 falls "$step" "$turns $angles s.body_1.q[0] = 0.01;" ""
tree 12000 arm "$step" 's.body_0.x[0] = 0.3; s.body_1.x[0] = 0.2; s.body_0.p[0] = 0.5; s.body_0.q[0] = 0.01;' ""
tree 8500 bars "$step" 's.body_0.p[0] = 0.3;' "" 3 # gcc makes the last selection before a check of loops a branch, of 3
tree 28300 deploys "$step" "$turns s.body_1.p[0] = 0.03;" "" 3
tree 32000 rotors "$step" "s.body_0.p[5] = 3; s.body_0.rotor_momentum[0] = 9; s.body_1.rotor_momentum[2] = 3;" "" 1
tree 27500 hinged_wheels "$step" 's.body_0.p[5] = 3; s.body_1.x[0] = s.body_2.x[0] = s.body_3.x[0] = 0.3; s.body_1.p[0] = 0.05;' ""
tree 28700 tether "$step" "$turns s.body_1.q[0] = 0.01;" "" 1
seconds=8 # 5.2: 6,525 lines, the inertia of the line twice, in the rates and in the motion
tree 55000 lines "$step" "$turns $angles s.body_1.q[0] = 0.1; s.body_1.q[3] = 0.05;" ""
seconds=
tree 9500 hinge "$stiff" "$turns $angles" --sdirk
tree 36500 booms "$stiff" "$turns $waves" --sdirk
tree 21100 turned "$stiff" "$turns s.body_1.x[0] = 0.01;" --sdirk
tree 58900 hinged_wheels "$stiff" 's.body_0.p[5] = 3; s.body_1.x[0] = s.body_2.x[0] = s.body_3.x[0] = 0.01; s.body_1.p[0] = 0.05;' --sdirk
tree 27500 arm "$stiff" 's.body_0.x[0] = 0.03; s.body_1.x[0] = 0.02; s.body_0.p[0] = 0.5; s.body_0.q[0] = 0.001;' --sdirk

ok "$models models agree with the library to $largest (single $single), with variable parameters to $varied, stiff ones by SDIRK to $implicit (single $single_implicit), lanes with single steps to the last bit; of $steps steps of $attacks models by numbers that are none and flipped bits $refused are refused and no other gives what is not finite; instructions of a step: ${counts#, }"
