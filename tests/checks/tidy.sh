#!/bin/sh
# clang-tidy (.clang-tidy) and cppcheck find nothing in the library, the tests, the examples and the benchmarks.
# cppcheck: uninitvar is off, it takes an array that is handed to the function that fills it for one that is read; gcc, clang
# and the analyzer of clang-tidy look for the same.
. tests/checks/common.sh
need clang-tidy clang-tidy
need cppcheck cppcheck
files="$(ls tests/test_*.c examples/*.c bench/*.c tests/checks/*.c | grep -v -e firmware.c -e target.c -e step_cost.c -e bench_peers -e rom.c -e checks/single.c)" # they want a generated header, or other libraries
for single in 0 1; do
  [ $single = 0 ] || files=$(echo "$files" | grep -v -e jacobian.c -e shape_rates.c) # are in double precision
  try clang-tidy --quiet $files -- -std=c99 -I. -DFB_SINGLE=$single
  try cppcheck --quiet --error-exitcode=1 --enable=warning,performance,portability --std=c99 -I. --suppress=uninitvar \
    --suppress=missingIncludeSystem --inline-suppr -UFLEXBEAM_CONFIG -DFB_SINGLE=$single $files
done
ok "clang-tidy $(clang-tidy --version | sed -n 's/.*version \([0-9.]*\).*/\1/p'), $(cppcheck --version): nothing found"
