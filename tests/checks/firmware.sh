#!/bin/sh
# The firmware example, bare metal, on an emulated Cortex-M4F (single precision) and Cortex-M7 (double): every number it
# prints is the desktop's, bit for bit; every step of the plant takes the same number of instructions; code, RAM and
# instructions keep their bounds, of four images by -Os one on each day; by the library and by the step that reduce --code wrote, which flies alike. A RISC-V 32 build; files of different configurations do not link for the board either.
. tests/checks/common.sh
. tests/checks/board.sh
need gcc gcc
need riscv64-unknown-elf-gcc "gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf"
bound_code=30208 # 24576 before momenta were relative to the mass center: what places O and turns onto L costs the rest; the comparison of modes 128
bound_ram=12288
bound_step=31300 # 12000 was the goal, see its README.md: this keeps what was reached since momenta are relative to the mass center (29000 before)
bound_generated_code=24832 # of the step that reduce --code wrote, bytes of the image; 17408 of the templates that it had before
bound_generated_step=9200
report=
flights=0

# flies NAME OPTIONS...: on the desktop and the board, by -O2 and -Os
flies() {
  run=$1
  shift
  try gcc $c99 -O2 $configuration -DFLEXBEAM_STATIC "$@" -o "$out/desktop" examples/firmware/firmware.c examples/firmware/board/desktop.c -lm
  "$out/desktop" > "$out/desktop_$run.txt" || fail "the desktop's run, $run: $(tail -n 1 "$out/desktop_$run.txt")"
  flights=$((flights + 1))
  for opt in -O2 $(today $flights && echo -Os); do
    numbers=$out/board_$run$opt.txt
    image "$out/firmware.elf" examples/firmware/firmware.c $opt "$@"
    emulate "$out/firmware.elf" "$numbers" || fail "$run $opt: $(tail -n 1 "$numbers")"
    grep -v '^instructions\|^stack' "$numbers" | cmp -s - "$out/desktop_$run.txt" || fail "$run $opt: the board's numbers are not the desktop's"
    arm-none-eabi-nm "$out/firmware.elf" | grep -E ' (_*(sqrt|sin|cos|atan2?|exp|pow|malloc)f?(_r)?|__ieee754.*|__aeabi_d.*)$' &&
      fail "$run $opt: the image calls that of libc or libm"
    fewest=$(sed -n 's/^instructions of a step, fewest //p' "$numbers")
    most=$(sed -n 's/^instructions of a step, most //p' "$numbers")
    stack=$(sed -n 's/^stack \[bytes\] //p' "$numbers")
    code=$(bytes "$out/firmware.elf" ".text .ARM.exidx") constants=$(bytes "$out/firmware.elf" .rodata)
    ram=$(($(bytes "$out/firmware.elf" ".data .bss") + stack))
    [ -n "$most" ] && [ -n "$stack" ] || fail "$run $opt: the board counted nothing"
    [ "$fewest" = "$most" ] || fail "$run $opt: a step takes $fewest to $most instructions"
    [ "$code" -le $most_code ] || fail "$run $opt: $code bytes of code, bound $most_code"
    [ $ram -le $bound_ram ] || fail "$run $opt: $ram bytes of RAM, bound $bound_ram"
    [ $opt != -O2 ] || [ "$most" -le $most_step ] || fail "$run: $most instructions a step, bound $most_step"
    report="$report; $run $opt code $code, constants $constants, RAM $ram, step $most"
  done
}

for precision in single double; do
  rom $precision
  most_code=$bound_code most_step=$bound_step
  flies $precision
  try build/flexbeam reduce "$out/satellite.txt" --code $([ $precision = double ] || echo --single) --out "$model/satellite_code.h"
  most_code=$bound_generated_code most_step=$bound_generated_step
  flies generated_$precision -DGENERATED=1 -DFLEXBEAM_STATIC
  arm-none-eabi-nm "$out/firmware.elf" | grep -E ' fb_(rk4|body)' && fail "a step of the library beside the generated one"
done
table() { # what is printed but digests and sizes
  grep -v -e '^digest' -e '\[bytes' "$1"
}
table "$out/desktop_double.txt" > "$out/library.txt"
table "$out/desktop_generated_double.txt" | cmp -s "$out/library.txt" - || fail "the generated step flies otherwise than the library"
rom single
try riscv64-unknown-elf-gcc --specs=picolibc.specs -march=rv32imafc -mabi=ilp32f -std=c99 $base \
  -fno-math-errno -Os $configuration -DFLEXBEAM_STATIC -c -o "$out/riscv.o" examples/firmware/firmware.c
riscv=$(riscv64-unknown-elf-size "$out/riscv.o" | awk 'NR == 2 { print $1 }')
printf '#include "flexbeam.h"\nint main(void)\n{\n  return fb_version_string()[0];\n}\n' > "$out/user.c"
cross="arm-none-eabi-gcc -std=c99 -I. $processor -mthumb -mfloat-abi=hard -O2 -ffunction-sections -fdata-sections"
try $cross -c -o "$out/impl.o" "$out/impl.c"
for option in FB_MAX_MODES=12 FB_MAX_MODES=6; do
  linked=yes
  $cross -D$option -nostartfiles -Wl,--gc-sections -Wl,-e,main -o "$out/user.elf" "$out/user.c" "$out/impl.o" 2> "$out/log" || linked=no
  [ $option$linked != FB_MAX_MODES=12no ] && [ $option$linked != FB_MAX_MODES=6yes ] || {
    cat "$out/log"
    fail "on the board -D$option links: $linked"
  }
done
ok "same bits as the desktop$report; RISC-V 32 $riscv bytes with the model"
