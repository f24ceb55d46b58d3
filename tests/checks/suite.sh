#!/bin/sh
# The tests pass with gcc and clang in both precisions, and as C++11; gcc in double precision is `make test`.
. tests/checks/common.sh
need gcc gcc
need g++ g++
need clang clang
result=
for run in "gcc 1" "clang 0" "clang 1" "g++ 0"; do
  set -- $run
  case $1 in
  g++) try g++ -x c++ -std=c++11 $base -O2 -o "$out/runner" tests/test_*.c -lm ;;
  *) try $1 $c99 -O2 -DFB_SINGLE=$2 -o "$out/runner" tests/test_*.c -lm ;;
  esac
  try "$out/runner"
  result="$result, $1 $([ $2 = 1 ] && echo single || echo double) $(tail -n 1 "$out/log" | cut -d ' ' -f 1)"
done
ok "tests passed:${result#,}"
