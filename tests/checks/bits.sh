#!/bin/sh
# Every stepper under random loads: the same bits from gcc and clang at -O0, -O2 (single precision; the boards and MIPS in both),
# -O3, twice, on Cortex-M4F and -M7, and on a big-endian 32-bit machine (MIPS), in one precision by day; on the boards the same
# number of instructions in every step (but of the exact beam in double, and of friction and stops: bench/target.c). Again with the beam as a line of large
# deflection. FLEXBEAM_STATIC: what no stepper calls is not compiled.
# make bench-jitter counts 100,000 of them.
. tests/checks/common.sh
. tests/checks/board.sh
need gcc gcc
need clang clang
need qemu-mips qemu-user
need mips-linux-gnu-gcc "gcc-mips-linux-gnu libc6-dev-mips-cross"
steps=1000
precisions=$(turn single double)
: > "$out/counts"
for kind in full large; do # large: lines of large deflection, by fewer compilers, a tenth of the steps
  [ $kind = full ] || steps=$(((steps + 9) / 10))
  for precision in $precisions; do
    case $kind-$precision in
    full-single) compilers="gcc:-O0 gcc:-O2 gcc:-O3 clang:-O0 clang:-O2 clang:-O3" ;;
    full-double) compilers="gcc:-O0 gcc:-O3 clang:-O0 clang:-O3" ;;
    large-*) compilers="gcc:-O0 clang:-O3" ;;
    esac
    rom $precision $kind
    options="$configuration $library_small -DFLEXBEAM_STATIC -DBODY_HEADER=\"satellite_rom.h\" -DBODY=satellite"
    rm -f "$model/bits.txt"
    for compiler in $compilers; do
      try ${compiler%:*} $c99 ${compiler#*:} $options -DSTEPS=$steps -o "$out/target" bench/target.c examples/firmware/board/desktop.c -lm
      for run in first second; do
        "$out/target" > "$out/bits.txt" || fail "$kind, $precision $compiler: $(tail -n 1 "$out/bits.txt")"
        [ -f "$model/bits.txt" ] || cp "$out/bits.txt" "$model/bits.txt"
        cmp -s "$out/bits.txt" "$model/bits.txt" || fail "$kind, $precision $compiler, $run run: other bits"
      done
    done
    try mips-linux-gnu-gcc $c99 -O2 -static $options -DSTEPS=$steps -o "$out/target" bench/target.c examples/firmware/board/desktop.c -lm
    qemu-mips "$out/target" | cmp -s - "$model/bits.txt" || fail "$kind, $precision, MIPS: other bits"
    configuration=$options
    image "$out/target.elf" bench/target.c -O2 -DSTEPS="$steps"
    emulate "$out/target.elf" "$out/board.txt" || fail "$kind, $precision, board: $(cat "$out/board.txt")"
    cut -c 1-37 "$out/board.txt" | cmp -s - "$model/bits.txt" || fail "$kind, $precision, board: other bits"
    awk -v p="$precision $kind" '{ print "  " p, $0 }' "$out/board.txt" >> "$out/counts"
  done
done
echo "  steps, digest, instructions of each step, fewest and most"
cat "$out/counts"
ok "10 steppers, $precisions, without and with lines: same bits by gcc and clang at -O0 to -O3, on two boards and on MIPS, the same number of instructions (of the exact beam in single precision, but for friction and stops)"
