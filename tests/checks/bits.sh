#!/bin/sh
# Every stepper under random loads: the same bits from gcc and clang at -O0, -O2, -O3, twice, on Cortex-M4F and -M7, and on
# a big-endian 32-bit machine (MIPS), in both precisions; on the boards the same number of instructions in every step.
# STEPS=100000 make check-bits counts more of them (half an hour).
. tests/checks/common.sh
. tests/checks/board.sh
need gcc gcc
need clang clang
need qemu-mips qemu-user
need mips-linux-gnu-gcc "gcc-mips-linux-gnu libc6-dev-mips-cross"
few=300
many=${STEPS:-10000}
: > "$out/counts"
for precision in single double; do
  rom $precision
  options="$configuration $library_small -DBODY_HEADER=\"satellite_rom.h\" -DBODY=satellite"
  for cc in gcc clang; do
    for opt in -O0 -O2 -O3; do
      try $cc $c99 $opt $options -DSTEPS=$few -o "$out/target" bench/target.c examples/firmware/board/desktop.c -lm
      for run in first second; do
        "$out/target" > "$out/bits.txt" || fail "$precision $cc $opt: $(tail -n 1 "$out/bits.txt")"
        [ -f "$model/bits.txt" ] || cp "$out/bits.txt" "$model/bits.txt"
        cmp -s "$out/bits.txt" "$model/bits.txt" || fail "$precision $cc $opt, $run run: other bits"
      done
    done
  done
  try mips-linux-gnu-gcc $c99 -O2 -static $options -DSTEPS=$few -o "$out/target" bench/target.c examples/firmware/board/desktop.c -lm
  qemu-mips "$out/target" | cmp -s - "$model/bits.txt" || fail "$precision, MIPS: other bits"
  configuration=$options
  image "$out/target.elf" bench/target.c -O2 -DSTEPS=$few
  emulate "$out/target.elf" "$out/board.txt" || fail "$precision, board: $(cat "$out/board.txt")"
  cut -c 1-37 "$out/board.txt" | cmp -s - "$model/bits.txt" || fail "$precision, board: other bits"
  image "$out/target.elf" bench/target.c -O2 -DSTEPS="$many"
  emulate "$out/target.elf" "$out/board.txt" || fail "$precision, $many steps: $(cat "$out/board.txt")"
  awk -v p=$precision '{ print "  " p, $0 }' "$out/board.txt" >> "$out/counts"
done
echo "  instructions of each of $many steps, fewest and most"
cat "$out/counts"
ok "9 steppers in both precisions: same bits by gcc and clang at -O0, -O2, -O3, on two boards and on MIPS, always the same number of instructions"
