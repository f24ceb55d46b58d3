#!/bin/sh
# The tests run more than 95 % of the lines of the library and take more than 85 % of its branches (gcc, double precision; long
# runs are brief, they show no other code; every fourth day). By section: build/coverage/table.txt; what is left out: build/coverage/uncovered.txt.
. tests/checks/common.sh
need gcc gcc
need gcov gcc
today 3 || {
  ok "measured every fourth day"
  exit 0
}
results=build/coverage
rm -rf $results
mkdir -p $results
try gcc $c99 -O1 -DFBT_SHORT=1 --coverage -c -o "$out/library.o" tests/test_main.c
try gcc $c99 -O1 -DFBT_SHORT=1 -o "$out/runner" "$out/library.o" $(ls tests/test_*.c | grep -v test_main) -lgcov -lm
try "$out/runner"
passed=$(tail -n 1 "$out/log")
try gcov --branch-probabilities --branch-counts --stdout --object-directory "$out/library.o" tests/test_main.c
awk -v uncovered=$results/uncovered.txt -f tests/checks/coverage.awk "$out/log" > $results/table.txt || {
  cat $results/table.txt
  fail "more than 95 % of the lines and 85 % of the branches are to be run: see $results/uncovered.txt"
}
ok "$(awk '$1 == "all" { print $3 " % of the lines and " $6 " % of the branches run" }' $results/table.txt) ($passed)"
