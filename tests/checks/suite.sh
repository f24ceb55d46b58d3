#!/bin/sh
# The tests pass in single precision by clang, every fourth day in double by gcc, long runs whole, and those of the forms as C++11
# by g++. Others run them by gcc in double precision with long runs brief (`make test`, check-sanitize) and by clang
# (check-memory); check-bits shows that both compilers give the same bits in both precisions.
. tests/checks/common.sh
need g++ g++
need clang clang
result=
# compiler, FB_SINGLE, FBT_SHORT, optimization of the library, which tests
whole=
! today 1 || whole="gcc 0 0 -O2"
for run in "clang 1 0 -O2" "g++ 0 1 -O1 forms/" ${whole:+"$whole"}; do
  set -- $run
  options="-DFB_SINGLE=$2 -DFBT_SHORT=$3"
  case $1 in
  g++) build="g++ -x c++ -std=c++11 $base $options" ;;
  *) build="$1 $c99 $options" ;;
  esac
  try $build $4 -c -o "$out/library.o" tests/test_main.c
  try $build -O0 -o "$out/runner" $(ls tests/test_*.c | grep -v test_main) -x none "$out/library.o" -lm
  try "$out/runner" ${5:-}
  result="$result, $1 $([ $2 = 1 ] && echo single || echo double) $(tail -n 1 "$out/log" | cut -d ' ' -f 1)"
done
ok "tests passed:${result#,}"
