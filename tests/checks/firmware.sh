#!/bin/sh
# The firmware example, bare metal, on an emulated Cortex-M4F (single precision) and Cortex-M7 (double): every number it
# prints is the desktop's, bit for bit; every step of the plant takes the same number of instructions; code, RAM and
# instructions keep their bounds. A RISC-V 32 build; files of different configurations do not link for the board either.
. tests/checks/common.sh
. tests/checks/board.sh
need gcc gcc
need riscv64-unknown-elf-gcc "gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf"
bound_code=29952 # 24576 before momenta were relative to the mass center: what places O and turns onto L costs the rest
bound_ram=12288
bound_step=31300 # 12000 was the goal, see its README.md: this keeps what was reached since momenta are relative to the mass center (29000 before)
report=
for precision in single double; do
  rom $precision
  try gcc $c99 -O2 $configuration -o "$out/desktop" examples/firmware/firmware.c examples/firmware/board/desktop.c -lm
  "$out/desktop" > "$out/desktop.txt" || fail "the desktop's run, $precision: $(tail -n 1 "$out/desktop.txt")"
  for opt in -O2 -Os; do
    image "$out/firmware.elf" examples/firmware/firmware.c $opt
    emulate "$out/firmware.elf" "$out/board_$precision$opt.txt" || fail "$precision $opt: $(tail -n 1 "$out/board_$precision$opt.txt")"
    grep -v '^instructions\|^stack' "$out/board_$precision$opt.txt" | cmp -s - "$out/desktop.txt" ||
      fail "$precision $opt: the board's numbers are not the desktop's"
    arm-none-eabi-nm "$out/firmware.elf" | grep -E ' (_*(sqrt|sin|cos|atan2?|exp|pow|malloc)f?(_r)?|__ieee754.*|__aeabi_d.*)$' &&
      fail "$precision $opt: the image calls that of libc or libm"
    fewest=$(sed -n 's/^instructions of a step, fewest //p' "$out/board_$precision$opt.txt")
    most=$(sed -n 's/^instructions of a step, most //p' "$out/board_$precision$opt.txt")
    stack=$(sed -n 's/^stack \[bytes\] //p' "$out/board_$precision$opt.txt")
    code=$(bytes "$out/firmware.elf" ".text .ARM.exidx") constants=$(bytes "$out/firmware.elf" .rodata)
    ram=$(($(bytes "$out/firmware.elf" ".data .bss") + stack))
    [ -n "$most" ] && [ -n "$stack" ] || fail "$precision $opt: the board counted nothing"
    [ "$fewest" = "$most" ] || fail "$precision $opt: a step takes $fewest to $most instructions"
    [ "$code" -le $bound_code ] || fail "$precision $opt: $code bytes of code, bound $bound_code"
    [ $ram -le $bound_ram ] || fail "$precision $opt: $ram bytes of RAM, bound $bound_ram"
    [ $opt != -O2 ] || [ "$most" -le $bound_step ] || fail "$precision: $most instructions a step, bound $bound_step"
    report="$report; $precision $opt code $code, constants $constants, RAM $ram, step $most"
  done
done
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
