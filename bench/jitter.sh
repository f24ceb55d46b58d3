#!/bin/sh
# make bench-jitter: instructions of each of 100,000 steps (STEPS) of every stepper under random loads, bench/target.c on an emulated
# Cortex-M4F (single precision) and -M7 (double): how many steps took how many. Exit: 0, 1 where one varies that must not.
set -eu
out=build/jitter
mkdir -p "$out"
fail() {
  echo "$*"
  exit 1
}
try() {
  "$@" > "$out/log" 2>&1 || { cat "$out/log"; exit 1; }
}
need() {
  command -v "$1" > /dev/null || fail "make bench-jitter wants: apt-get install gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm"
}
base="-I. -ffp-contract=off $WARNINGS"
. tests/checks/board.sh
for precision in single double; do
  rom $precision
  configuration="$configuration $library_small -DFLEXBEAM_STATIC -DBODY_HEADER=\"satellite_rom.h\" -DBODY=satellite -DHISTOGRAM"
  image "$out/target.elf" bench/target.c -O2 -DSTEPS="${STEPS:-100000}"
  echo "$precision precision: steps, instructions of a step: fewest, most; where they differ, how many steps took how many"
  emulate "$out/target.elf" "$out/board.txt" || fail "$(cat "$out/board.txt")"
  awk 'function show() { if (n > 1) for (i = 1; i <= n; i++) print line[i]; n = 0 }
    /^[a-z]/ { show(); print substr($0, 1, 27) substr($0, 38); next } { line[++n] = $0 } END { show() }' "$out/board.txt"
done
