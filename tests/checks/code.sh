#!/bin/sh
# The generated step (reduce --code): twenty random models, every set of effects and geometrically exact lines agree with fb_rk4_step
# after 1,000 steps, on each base, with loads and without, and refuse what it refuses; the text compiles without warnings as C99 and C++ and is the same each time; its
# instructions keep their bounds and do not vary; the step with variable parameters agrees with the library and descriptions that have them;
# lanes have the bits of single steps.
. tests/checks/common.sh
. tests/checks/board.sh
need gcc gcc
need g++ g++
need clang clang
need valgrind valgrind
bound_6=6300 # instructions of a step, modes with every effect
bound_12=12000
bound_falls=9400 # 4 modes in gravity of a center (46,971 by the library)
bound_wheels=7500 # satellite of 8 modes with three wheels
bound_lines=48800 # 6 modes and 6 points of a geometrically exact line; 42000 were aimed at and are missed
bound_board_6=6800 # on a Cortex-M4F, single precision
bound_board_12=12500
flags="-DFB_MAX_MODES=12 -DFB_MAX_NODES=8 -DFB_WITH_BUILD=0 -DFB_WITH_SYSTEM=0 -DFB_WITH_EXACT=0"
try gcc $c99 $flags -O1 -c -o "$out/double.o" "$out/impl.c"
try gcc $c99 $flags -DFB_SINGLE=1 -O1 -c -o "$out/single.o" "$out/impl.c"

base_is=free
given= # further options of the compiler
loads= # nodes with loads
rotors= # their nodes, see code.awk
central= # mu of gravity of a center
# generate SEED EFFECTS [--single]: the text and the model in ROM of a random body with base_is
generate() {
  awk -v seed="$1" -v effects="$2" -v base="$base_is" -v rotors="$rotors" -v central="$central" -f tests/checks/code.awk > "$out/random.txt"
  write "$2" ${3:-}
}

# write EFFECTS [--single]: of random.txt
write() {
  try build/flexbeam reduce "$out/random.txt" --name generated ${2:-} --out "$out/rom.h"
  try build/flexbeam reduce "$out/random.txt" --name generated --code ${loads:+--loads $loads} ${2:-} --out "$out/code.h"
}

# agree OPTIMIZATION [--single]: what was generated with the library; sets worst
agree() {
  precision=${2:+single}
  try gcc $c99 $flags ${2:+-DFB_SINGLE=1} $1 $given -DBASE="$(echo $base_is | tr a-z A-Z)" -I"$out" -o "$out/run" tests/checks/code.c "$out/${precision:-double}.o" -lm
  "$out/run" > "$out/log" || {
    cat "$out/log" "$out/random.txt"
    fail "the step above"
  }
  worst=$(sed -n 's/.*worst //p' "$out/log")
}

# compile [--single]: without warnings everywhere
compile() {
  printf '#define generated_IMPLEMENTATION\n#include "code.h"\nint main(void) { generated_state s; generated_start(&s); return generated_step(&s, 0, 0, 0, s.quat[0]); }\n' > "$out/main.c"
  try clang $c99 -O2 -I"$out" -fsyntax-only "$out/main.c"
  try g++ -x c++ -std=c++11 $base -O2 -I"$out" -fsyntax-only "$out/main.c"
  try clang++ -x c++ -std=c++20 $base -O2 -I"$out" -fsyntax-only "$out/main.c"
}

largest=0
note() {
  models=$((models + 1))
  largest=$(printf '%s\n%s\n' "$largest" "$worst" | sort -g | tail -n 1)
}

# look_at SEED EFFECTS: a random body, generated, beside the library
look_at() {
  generate $1 "$2"
  agree -O0
  note
}

models=0
seed=0
while [ $seed -lt 20 ]; do
  seed=$((seed + 1))
  today $seed || continue
  look_at $seed "full damping"
done
for effects in rigid linear acceleration_stiffening "spin_stiffening acceleration_stiffening" spin "spin acceleration_stiffening" \
  "spin spin_stiffening acceleration_stiffening" full "linear damping" "full gravity" "full damping gravity"; do
  look_at 8 "$effects"
done
for base_is in pinned prescribed; do
  for effects in rigid "rigid gravity" linear "spin gravity" full "full damping gravity"; do
    look_at 10 "$effects"
  done
  generate 5 "full damping gravity"
  compile
  generate 5 "full damping gravity" --single
  compile
  agree -O2 --single
done

# a hinge, nonlinear strain, rotors with an imbalance
both() {
  for precision in "" --single; do
    $1 "$2" "$3" $precision
    compile
    agree -O2 $precision
  done
}
strain() {
  printf 'beam\nlength 10\nelements 3\nhub 50 0 0 0  20 30 40\nstations x mass EA EI_z\n0 1.2 3e6 14004\nend\nfunctions 3 root_strain\nmodes bend_y 3 axial 3\neffects strain%s\ndamping 0.01\nbase %s\n' "$1" $2 > "$out/random.txt"
  write "$1" ${3:-}
}
wobble() {
  { # the first line names the parts
    awk -v seed=$1 -v effects="full damping gravity" -v base=$2 -f tests/checks/code.awk
    printf 'rotor wheel 1\naxis 1 0 0\ninertia 0.1\nstatic_imbalance 1e-3\ndynamic_imbalance 2e-3 30\nend\n'
  } > "$out/random.txt"
  write "" ${3:-}
}
base_is=hinged
both generate 10 rigid
both generate 10 "full damping gravity"
base_is=free
both strain " damping" free
given=-DROTORS=1
both wobble 3 free
base_is=prescribed
both wobble 5 prescribed
base_is=free
given=
generate 5 "full damping"
cp "$out/code.h" "$out/first.h"
compile
generate 5 "full damping"
cmp -s "$out/first.h" "$out/code.h" || fail "the text differs from one run to the next"
generate 5 "full damping" --single
compile
for seed in 1 5 12; do
  generate $seed "full damping" --single
  agree -O2 --single
done
single=$worst

# loads at nodes, on the deformed body
polynomial=$largest
largest=0
loads=1,2
given=-DLOADED
for base_is in pinned prescribed free; do
  look_at 3 "full damping gravity"
done
look_at 8 rigid
generate 5 "full damping"
compile
generate 12 full --single
compile
agree -O2 --single
loaded=$largest
largest=$polynomial
loads=
given=

# rotors on the hub and on nodes that bend, with friction, some of given momentum (g); SEED:EFFECTS:BASE:ROTORS
polynomial=$largest
largest=0
wheels=0
for wheel in "3:full damping:free:1 0 1" "3:full damping:free:2 1 0g" "5:full damping gravity:pinned:2 0 1g" \
  "5:full damping gravity:prescribed:2 0 1g 0" "8:rigid:free:0 1g" "8:linear:free:1 2" "8:spin acceleration_stiffening:free:2g 2" \
  "7:full damping:free:2 2 1 0" "10:linear:pinned:2 0g" "14:large damping:free:0 1g" "4:large damping gravity:prescribed:0 1"; do
  base_is=$(echo "$wheel" | cut -d : -f 3)
  rotors=$(echo "$wheel" | cut -d : -f 4)
  given=-DROTORS=$(echo $rotors | wc -w)
  generate "$(echo "$wheel" | cut -d : -f 1)" "$(echo "$wheel" | cut -d : -f 2)"
  compile
  agree -O0
  note
  wheels=$((wheels + 1))
done
base_is=free
rotors="0 1 2"
given=-DROTORS=3
generate 12 "full damping" --single
compile
agree -O2 --single
turning=$largest
largest=$polynomial
rotors=
given=

# gravity of a center, beside uniform one, rotors and loads at nodes; near the center, too; SEED:EFFECTS:BASE:ROTORS
polynomial=$largest
largest=0
central=400
fields=0
loads=1,2
for field in "3:full damping:free:" "4:full:free:1 2 0g" "9:full gravity:free:" "8:rigid:free:" "8:rigid gravity:pinned:0 1g" \
  "9:full damping:pinned:" "7:full damping gravity:pinned:2 0 1g" "5:full:prescribed:2 0 1g 0" "10:rigid gravity:prescribed:"; do
  base_is=$(echo "$field" | cut -d : -f 3)
  rotors=$(echo "$field" | cut -d : -f 4)
  given="-DLOADED ${rotors:+-DROTORS=$(echo $rotors | wc -w)}"
  generate "$(echo "$field" | cut -d : -f 1)" "$(echo "$field" | cut -d : -f 2)"
  compile
  agree -O0
  note
  fields=$((fields + 1))
done
base_is=free
rotors="0 1 2"
given="-DLOADED -DROTORS=3"
generate 12 "full damping" --single
compile
agree -O2 --single
attracted=$largest
largest=$polynomial
loads=
rotors=
given=
central=

# geometrically exact lines: curved, twisted, tapered, solid, beside components, on each base, by seed
polynomial=$largest
largest=0
lines=0
for seed in 1 3 4 5 10 11 14 17; do
  today $seed || continue
  look_at $seed "large damping"
  lines=$((lines + 1))
done
for base_is in pinned prescribed; do
  for seed in 4 14; do
    look_at $seed "large damping gravity"
    lines=$((lines + 1))
  done
done
generate 14 "large gravity"
compile
base_is=hinged
look_at 4 "large damping"
# with loads at nodes, rotors and gravity of a center
base_is=free
loads=1,2
rotors="0 1 2g"
central=400
given="-DLOADED -DROTORS=3"
for seed in 4 5; do
  look_at $seed "large damping"
  lines=$((lines + 1))
done
loads=
rotors=
central=
given=
generate 5 "large damping" --single
compile
agree -O2 --single
generate 5 "large damping"
cp "$out/code.h" "$out/first.h"
compile
generate 5 "large damping"
cmp -s "$out/first.h" "$out/code.h" || fail "the text of lines differs from one run to the next"
exact=$largest
largest=$polynomial

# vary SEED EFFECTS LIST FACTORS [--single]: the step with these parameters variable (in the order of the help) against the library and a
# description that has them
vary() {
  options=$(echo "$3 $4" | awk '{ n = split($1, name, ","); split($2, x, ","); for (k = 1; k <= n; k++) printf "-v %s=%s ", name[k], x[k] }')
  mass=$(echo "$options" | sed -n 's/.*-v mass=\([^ ]*\).*/\1/p')
  number=$(echo "$3" | tr ',' '\n' | grep -n '^damping$' | cut -d : -f 1)
  awk -v seed="$1" -v effects="$2" -v base="$base_is" -v central="$central" -f tests/checks/code.awk > "$out/random.txt"
  awk -v seed="$1" -v effects="$2" -v base="$base_is" -v central="$central" $options -f tests/checks/code.awk > "$out/changed.txt"
  try build/flexbeam reduce "$out/random.txt" --name generated --code --vary "$3" ${loads:+--loads $loads} ${5:-} --out "$out/code.h"
  try build/flexbeam reduce "$out/changed.txt" --name generated ${5:-} --out "$out/rom.h"
  given="${tolerance:+-DTOLERANCE=$tolerance} ${loads:+-DLOADED} -DVARY=FB_R($(echo "$4" | sed 's/,/),FB_R(/g')) -DMASS=${mass:-1} -DDAMPING=$((${number:-0} - 1))"
  agree -O0 ${5:-}
  varied=$((varied + 1))
}
varied=0
tolerance=
all=stiffness,damping,mass,hub_mass,hub_inertia
undamped=stiffness,mass,hub_mass,hub_inertia
largest=0
for seed in 3 12 17; do # powers of 4: modes are the same to the last bit
  vary $seed "full damping" $all 4.0,0.6,0.25,0.8,1.2
  note
done
for effects in rigid linear spin "spin acceleration_stiffening" "full gravity"; do
  list=$([ "$effects" = rigid ] && echo mass,hub_mass,hub_inertia || echo $undamped)
  vary 8 "$effects" $list $([ "$effects" = rigid ] && echo 0.25,0.8,1.2 || echo 0.25,4.0,0.8,1.2)
  note
done
for base_is in pinned prescribed hinged; do
  vary 10 "full damping gravity" $all 4.0,0.6,0.25,0.8,1.2
  note
done
base_is=free
vary 14 "large damping" stiffness,damping 4.0,0.6
note
vary 14 "large damping" stiffness,damping 4.0,0
note
strain " damping" free
sed 's/^0 1.2 3e6 14004/0 0.3 12e6 56016/; s/^damping.*/damping 0.006/; s/^hub.*/hub 40 0 0 0  24 36 48/' "$out/random.txt" > "$out/changed.txt"
try build/flexbeam reduce "$out/random.txt" --name generated --code --vary $all --out "$out/code.h"
try build/flexbeam reduce "$out/changed.txt" --name generated --out "$out/rom.h"
given="-DVARY=FB_R(4.0),FB_R(0.6),FB_R(0.25),FB_R(0.8),FB_R(1.2) -DMASS=0.25 -DDAMPING=1"
agree -O0
note
loads=2,1
vary 3 "full damping" $all 4.0,0.6,0.25,0.8,1.2
note
loads=
central=400
vary 3 "full damping" $all 4.0,0.6,0.25,0.8,1.2
note
vary 8 rigid mass,hub_mass,hub_inertia 0.25,0.8,1.2
note
central=
vary 7 "full damping" hub_mass 1.3
note
exactly=$largest
largest=0
# other factors: modes of the two descriptions are solved separately, lowest frequencies to about 1e-11
tolerance=1e-10
vary 5 "full damping gravity" $all 1.3,0.6,1.7,0.8,1.2
note
vary 7 "full damping" stiffness,damping 0.7,1.5
note
apart=$largest
tolerance=
vary 12 "full damping" $all 1.3,0.6,1.7,0.8,1.2 --single
given=
largest=$polynomial

# lanes OPTION...: those of what was generated, bit for bit; on a machine without these vectors they are compiled alone
lanes() {
  try gcc $c99 -O1 $given -DPRESCRIBED=$([ $base_is = prescribed ] && echo 1 || echo 0) "$@" -I"$out" -o "$out/run" tests/checks/code_lanes.c -lm
  case " $* " in
  *avx512f*) grep -q avx512f /proc/cpuinfo || return 0 ;;
  *avx2*) grep -q avx2 /proc/cpuinfo || return 0 ;;
  esac
  try "$out/run"
}
given=-DNUMBER=double
awk -v seed=3 -v effects="full damping" -v base=free -f tests/checks/code.awk > "$out/random.txt"
try build/flexbeam reduce "$out/random.txt" --name generated --code --lanes --out "$out/code.h"
lanes -mavx2
given="-DNUMBER=double -DVARY"
try build/flexbeam reduce "$out/random.txt" --name generated --code --lanes --vary $all --out "$out/code.h"
for width in 1 2 4 8; do
  lanes -Dgenerated_LANES=$width
done
given="-DNUMBER=float -DVARY"
try build/flexbeam reduce "$out/random.txt" --name generated --code --lanes --single --vary $all --loads 1,2 --out "$out/code.h"
lanes -Dgenerated_LANES=4
given="-DNUMBER=double -DVARY"
try build/flexbeam reduce "$out/random.txt" --name generated --code --lanes --vary $all --out "$out/code.h"
lanes -mavx2 -Dgenerated_LANES=4
lanes -mavx512f -Dgenerated_LANES=8
try g++ -x c++ -std=c++11 $base -O1 $given -DPRESCRIBED=0 -I"$out" -o "$out/run" tests/checks/code_lanes.c -lm
try "$out/run"
try clang $c99 -O1 -mavx2 $given -DPRESCRIBED=0 -I"$out" -o "$out/run" tests/checks/code_lanes.c -lm
! grep -q avx2 /proc/cpuinfo || try "$out/run"
if command -v arm-none-eabi-gcc > /dev/null; then
  try arm-none-eabi-gcc $c99 -O1 -mcpu=cortex-a9 -mfpu=neon -mfloat-abi=hard $given -DPRESCRIBED=0 -I"$out" -c -o "$out/neon.o" tests/checks/code_lanes.c
fi
for base_is in pinned prescribed; do
  awk -v seed=5 -v effects="full damping gravity" -v base=$base_is -f tests/checks/code.awk > "$out/random.txt"
  try build/flexbeam reduce "$out/random.txt" --name generated --code --lanes --vary $all --out "$out/code.h"
  lanes -Dgenerated_LANES=4
done
base_is=free
given="-DNUMBER=double"
awk -v seed=3 -v effects="full damping" -v base=free -v rotors="0 2 1g" -f tests/checks/code.awk > "$out/wheels.txt"
try build/flexbeam reduce "$out/wheels.txt" --name generated --code --lanes --out "$out/code.h"
lanes -Dgenerated_LANES=4
lanes -mavx2 -Dgenerated_LANES=4
for base_is in free pinned prescribed; do
  awk -v seed=3 -v effects="full damping" -v base=$base_is -v rotors="0 2 1g" -v central=400 -f tests/checks/code.awk > "$out/wheels.txt"
  try build/flexbeam reduce "$out/wheels.txt" --name generated --code --lanes --out "$out/code.h"
  lanes -Dgenerated_LANES=4
done
base_is=free
given="-DNUMBER=float -DVARY"
sed -i 's/^base.*/base free/' "$out/random.txt"
try build/flexbeam reduce "$out/random.txt" --name generated --code --lanes --vary $all --single --out "$out/code.h"
lanes -Dgenerated_LANES=4
for base_is in free pinned prescribed hinged; do
  for option in "" --single; do
    given="-DNUMBER=$([ $option ] && echo float || echo double)"
    awk -v seed=3 -v effects="full damping gravity" -v base=$base_is -v rotors="0 2 1g" -f tests/checks/code.awk > "$out/wheels.txt"
    try build/flexbeam reduce "$out/wheels.txt" --name generated --code --lanes $option --out "$out/code.h"
    lanes -Dgenerated_LANES=4
    given="$given -DVARY"
    awk -v seed=5 -v effects="full damping gravity" -v base=$base_is -f tests/checks/code.awk > "$out/random.txt"
    try build/flexbeam reduce "$out/random.txt" --name generated --code --lanes --vary $all $option --out "$out/code.h"
    lanes -Dgenerated_LANES=4
    try clang $c99 -O1 -mavx2 $given -DPRESCRIBED=$([ $base_is = prescribed ] && echo 1 || echo 0) -I"$out" -o "$out/run" tests/checks/code_lanes.c -lm
    ! grep -q avx2 /proc/cpuinfo || try "$out/run" # numbers of a model are not aligned
  done
done
base_is=free
given=
sed -i 's/^base.*/base free/' "$out/random.txt"
given=-DNUMBER=double
sed 's/^effects.*/effects large damping gravity/' "$out/random.txt" > "$out/other.txt"
try build/flexbeam reduce "$out/other.txt" --name generated --code --lanes --out "$out/code.h"
lanes -mavx2 -Dgenerated_LANES=4
strain " damping" free
given="-DNUMBER=double -DVARY"
try build/flexbeam reduce "$out/random.txt" --name generated --code --lanes --vary $all --out "$out/code.h"
lanes -mavx2 -Dgenerated_LANES=4
given=

# on_board: instructions of a step of what was generated, in single precision; sets count
precision single
configuration="-I$out -O2"
on_board() {
  sed 's/int main.*//' "$out/main.c" > "$out/board.c"
  cat >> "$out/board.c" <<'END'
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
}

# boom MODES [EFFECTS POINTS]: of each plane, with parameters where `list` has some, in a field; sets count
list=
field=
boom() {
  printf 'beam\n%s\nhub 500 0 0 0 80 80 80\nbase free\neffects %s\nlength 10\nelements 12\nmodes bend_y %s bend_z %s%s\nstations x mass EI_y EI_z\n0 1.2 14004 14004\nend\n' "$field" "${2:-full}" $1 $1 "${3:+ points $3}" > "$out/boom.txt"
  try build/flexbeam reduce "$out/boom.txt" --name generated --code ${list:+--vary "$list"} --out "$out/code.h"
  sed 's/return generated_step.*/s.L[2] = s.L[0] = 30; s.q[0] = 0.05; for (int k = 0; k < 50; k++) { if (generated_step(\&s, 0, 0, 0, 1e-3)) { return 1; } } return 0; }/'"${list:+;s/generated_step(/&\\&m, /; s/generated_state s;/& generated_model m; generated_model_init(\\&m, 0);/}" \
    "$out/main.c" > "$out/count.c"
  (ulimit -t 5 && try gcc $c99 -O2 -I"$out" -o "$out/count" "$out/count.c" -lm) || fail "$1 + $1 modes: more than 5 s to compile"
  rm -f "$out"/cg*
  try valgrind --tool=callgrind --callgrind-out-file="$out/cg" --toggle-collect=generated_step --dump-after=generated_step "$out/count"
  cat "$out"/cg.* | sed -n 's/^summary: //p' | grep -v '^0$' | sort -n | uniq > "$out/counts"
  [ "$(wc -l < "$out/counts")" = 1 ] || fail "$1 + $1 modes: steps differ in their number of instructions: $(tr '\n' ' ' < "$out/counts")"
  count=$(cat "$out/counts")
}
boom 3 large 6
count_lines=$count
[ "$count_lines" -le $bound_lines ] || fail "lines of 6 points, 6 modes: $count_lines instructions, more than $bound_lines"
field="central_gravity 3.986e14 0 0 -7e6"
boom 2
count_falls=$count
[ "$count_falls" -le $bound_falls ] || fail "4 modes in gravity of a center: $count_falls instructions, more than $bound_falls"
field=
boom 3
count_6=$count
try build/flexbeam reduce "$out/boom.txt" --name generated --code --single --out "$out/code.h"
on_board
board_6=$count
count=$count_6
[ "$count" -le $bound_6 ] || fail "6 modes: $count instructions, more than $bound_6"
list=$undamped
boom 3
count_varied=$count
list=
[ $((100 * count_varied)) -le $((112 * count_6)) ] || fail "6 modes with parameters: $count_varied instructions, more than 1.12 times $count_6"
boom 6
count_12=$count
try build/flexbeam reduce "$out/boom.txt" --name generated --code --single --out "$out/code.h"
on_board
board_12=$count
[ "$count_12" -le $bound_12 ] || fail "12 modes: $count_12 instructions, more than $bound_12"
[ "$board_6" -le $bound_board_6 ] || fail "6 modes on the board: $board_6 instructions, more than $bound_board_6"
[ "$board_12" -le $bound_board_12 ] || fail "12 modes on the board: $board_12 instructions, more than $bound_board_12"

# the satellite with three wheels, of which one turns: instructions, and those of fb_rk4_step
try build/flexbeam reduce examples/satellite_wheels.txt --name generated --code --out "$out/code.h"
try build/flexbeam reduce examples/satellite_wheels.txt --name generated --out "$out/rom.h"
cat > "$out/count.c" <<'END'
#include "flexbeam.h"
#define generated_IMPLEMENTATION
#include "code.h"
#undef generated_crc
#include "rom.h"
int main(void)
{
  static generated_state s;
  static fb_state state;
  static fb_rk4_work work;
  int refused = fb_state_init(&generated, &state) != FB_OK;
  generated_start(&s);
  s.L[1] = s.rotor_momentum[0] = state.L[1] = state.pi[generated.n] = 32;
  s.L[0] = state.L[0] = 3;
  s.q[0] = state.q[0] = 0.05;
  for (int k = 0; k < 50; k++) {
    refused |= generated_step(&s, 0, 0, 0, 1e-3) != generated_ok;
    refused |= fb_rk4_step(&generated, &state, &work, 0, 0, 0, 1e-3) != FB_OK;
  }
  return refused;
}
END
try gcc $c99 $flags -O2 -c -o "$out/fast.o" "$out/impl.c"
try gcc $c99 $flags -O2 -I"$out" -o "$out/count" "$out/count.c" "$out/fast.o" -lm
for f in generated_step fb_rk4_step; do
  rm -f "$out"/cg*
  try valgrind --tool=callgrind --callgrind-out-file="$out/cg" --toggle-collect=$f --dump-after=$f "$out/count"
  cat "$out"/cg.* | sed -n 's/^summary: //p' | grep -v '^0$' | sort -n | uniq > "$out/counts"
  [ $f = fb_rk4_step ] || [ "$(wc -l < "$out/counts")" = 1 ] || fail "satellite with wheels: steps differ in their number of instructions: $(tr '\n' ' ' < "$out/counts")"
  eval "count_$f=$(tail -n 1 "$out/counts")"
done
[ $count_generated_step -le $bound_wheels ] || fail "satellite with wheels: $count_generated_step instructions, more than $bound_wheels"

ok "$models models agree with the library to $largest (single $single), 4 with loads at nodes to $loaded, $wheels with rotors to $turning, $fields by gravity of a center to $attracted, $count_falls instructions at 4 modes; a step takes $count_6 instructions at 6 modes, $count_12 at 12, on the board $board_6 and $board_12; the satellite with three wheels $count_generated_step ($count_fb_rk4_step by the library); $varied with variable parameters agree to $exactly ($apart where modes are solved apart), $count_varied instructions; $lines with lines agree to $exact, $count_lines instructions at 6 modes and 6 points"
