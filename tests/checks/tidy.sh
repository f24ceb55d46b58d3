#!/bin/sh
# clang-tidy (.clang-tidy) and cppcheck find nothing in the library, the tests, the examples and the benchmarks, gcc's analyzer
# nothing in the library and the tests.
# cppcheck sees the library in either precision, clang-tidy in one of them by day; of the rest a fourth on each day: programs in
# double, tests in single; what differs are conversions, of which the compilers warn (compile.sh). FLEXBEAM_IMPL_INCLUDED leaves
# the library out of what does not use its inside; the paths of what does are followed where the library is looked at alone.
# cppcheck takes the library as a file of its own and finds what one file does wrong to another's functions by its analysis of the
# whole program.
# cppcheck: uninitvar and ctuuninitvar are off, they take an array that is handed to the function that fills it for one that is
# read; gcc, clang and the analyzer of clang-tidy look for the same. gcc's analyzer takes what a loop has filled for such, too; with values
# followed any deeper the library wants more than the 2 GB that it takes now.
. tests/checks/common.sh
need clang-tidy clang-tidy
need cppcheck cppcheck
need gcc gcc
files="$(ls tests/test_*.c examples/*.c examples/*/*.c bench/*.c tests/checks/*.c tests/hard/*.c | grep -v -e firmware.c -e target.c -e step_cost.c -e bench_peers -e campaign_mpi -e rom.c -e rom_rotors.c -e fmu2.c -e fmu3.c -e checks/single.c -e checks/trace.c -e tutorial_filter -e checks/code.c -e bench/lanes.c -e checks/advise.c -e checks/parts.c)" # they want a generated header, or other libraries
inside="bench/bench_exact.c bench/bench_system.c"
printf '#define FB_WITH_FORMS 1\n#include "flexbeam.h"\n#include "flexbeam_impl.h"\n' > "$out/library.c"
# look FILES FB_SINGLE OPTIONS...: by clang-tidy
look() {
  these=$1 single=$2
  shift 2
  try clang-tidy --quiet $these -- -std=c99 -I. -DFB_SINGLE=$single "$@"
}

# check FILES FB_SINGLE: by cppcheck, with the library
check() {
  try cppcheck --quiet --error-exitcode=1 --enable=warning,performance,portability --std=c99 -I. --suppress=uninitvar --suppress=ctuuninitvar \
    --suppress=missingIncludeSystem --inline-suppr -UFLEXBEAM_CONFIG -DFB_SINGLE=$2 -DFLEXBEAM_IMPL_INCLUDED "$out/library.c" $1
}

for library in $(turn examples/tools/library.c:0 tests/test_main.c:1); do
  look ${library%:*} ${library#*:}
done
look "--checks=-clang-analyzer-* $inside" 0

analyze="gcc -std=c99 -I. -O0 -fanalyzer -fanalyzer-call-summaries --param analyzer-max-svalue-depth=4 -Werror"
analyze="$analyze -Wno-analyzer-use-of-uninitialized-value -c -o $out/analyzed.o"
number=0 those= programs= tests=
for file in $files; do
  number=$((number + 1))
  today $number || continue
  those="$those $file"
  case $file in
  tests/test_main.c | bench/bench_exact.c | bench/bench_system.c | */library.c) ;;
  tests/test_*) tests="$tests $file" ;;
  *) programs="$programs $file" ;;
  esac
  case $file in
  tests/test_status_detail.c) ;; # has a copy of the library, which is last
  tests/test_*) try $analyze -DFLEXBEAM_IMPL_INCLUDED $file ;;
  esac
done
look "$programs" 0 -DFLEXBEAM_IMPL_INCLUDED
look "$tests" 1 -DFLEXBEAM_IMPL_INCLUDED
check "$those" 0
check "" 1 # the library alone
try $analyze -DFB_WITH_FORMS=1 "$out/impl.c"
ok "clang-tidy $(clang-tidy --version | sed -n 's/.*version \([0-9.]*\).*/\1/p'), $(cppcheck --version), gcc $(gcc -dumpfullversion) -fanalyzer: nothing found"
