#!/bin/sh
# The corpus of every harness of tests/fuzz runs clean by gcc's sanitizers, in both precisions; then each harness looks for
# more for some seconds by clang's libFuzzer (`make fuzz`: longer).
. tests/checks/common.sh
need gcc gcc
need clang "clang libclang-rt-14-dev, or the version of clang"
result=
for harness in api step import; do
  for single in 0 1; do
    try gcc -fsanitize=address,undefined -fno-sanitize-recover=all $c99 -O1 -DREPLAY -DFB_SINGLE=$single -o "$out/replay" tests/fuzz/$harness.c -lm
    try "$out/replay" tests/fuzz/corpus/$harness/*
  done
  result="$result, $harness $(ls tests/fuzz/corpus/$harness | wc -l) inputs"
done
FUZZ_SECONDS=${FUZZ_SECONDS:-24} sh tests/fuzz/fuzz.sh > "$out/log" 2>&1 || {
  cat "$out/log"
  fail "a finding: the above"
}
ok "${result#, } replayed in both precisions; $(awk 'NR > 1 { n += $3 } END { print n }' "$out/log") more by libFuzzer, nothing found"
