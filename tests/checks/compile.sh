#!/bin/sh
# Every program and test compiles without a warning: gcc and clang, both precisions, C99, C11 and C17; the library and its
# tests as C++11, too. C99 is optimized, so that the warnings that need flow analysis are on: the library in the tests by
# -O2, again in each program by -O1; and the library for a single mode, where arrays are shortest.
. tests/checks/common.sh
need gcc gcc
need g++ g++
need clang clang
count=0
try gcc -std=c99 -I. -o "$out/reduce" examples/reduce.c -lm
try "$out/reduce" examples/satellite.txt --single --out "$out/satellite_rom.h"
body='-DBODY=satellite -DBODY_HEADER="satellite_rom.h"'
rom="-I$out $(grep -o -e '-DFB_[A-Z_]*=[0-9]*' "$out/satellite_rom.h")"
for single in 0 1; do
  for forms in 0 1; do
    try gcc -std=c99 -O3 $base $WARNINGS_C -DFB_SINGLE=$single -DFB_WITH_FORMS=$forms -DFB_MAX_MODES=1 -c -o "$out/object.o" "$out/impl.c"
    count=$((count + 1))
  done
done
for cc in gcc clang; do
  cxx=$([ $cc = gcc ] && echo g++ || echo clang++)
  for single in 0 1; do
    for file in tests/test_*.c $(ls examples/*.c bench/*.c | grep -v -e firmware.c -e target.c -e step_cost.c -e bench_peers); do
      c99_level=$(case $file in tests/*) echo -O2 ;; *) echo -O1 ;; esac)
      for std in "c99 $c99_level" "c11 -fsyntax-only" "c17 -fsyntax-only"; do
        try $cc -std=$std $base $WARNINGS_C -DFB_SINGLE=$single -c -o "$out/object.o" "$file"
        count=$((count + 1))
      done
    done
    for file in "examples/firmware.c" "bench/target.c $body" "bench/step_cost.c -DDESKTOP $body" examples/board/desktop.c; do
      try $cc -std=c99 -O2 $base $WARNINGS_C $rom -c -o "$out/object.o" $file
      count=$((count + 1))
    done
    for file in tests/test_*.c; do
      try $cxx -x c++ -std=c++11 $base -DFB_SINGLE=$single -c -o "$out/object.o" "$file"
      count=$((count + 1))
    done
  done
done
ok "$count compilations without a warning (gcc, clang x double, single x C99, C11, C17, C++11)"
