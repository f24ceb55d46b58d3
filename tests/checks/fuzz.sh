#!/bin/sh
# Every harness of tests/fuzz runs its corpus clean, under the address and undefined-behavior sanitizers, in both
# precisions, and looks for more for some seconds: `make fuzz`, which does so for longer. Of each harness one build on each day.
. tests/checks/common.sh
need clang "clang libclang-rt-14-dev, or the version of clang"
FUZZ_DAY=$([ -n "${CHECK_ALL:-}" ] || echo $day) FUZZ_SECONDS=${FUZZ_SECONDS:-4} sh tests/fuzz/fuzz.sh > "$out/log" 2>&1 || {
  cat "$out/log"
  fail "a finding: the above"
}
inputs=$(find tests/fuzz/corpus -type f | wc -l)
ok "$inputs inputs replayed in $(awk 'NR > 1 { print $1, $2 }' "$out/log" | paste -s -d , | sed 's/,/, /g'); $(awk 'NR > 1 { n += $3 } END { print n }' "$out/log") executions by libFuzzer, nothing found"
