#!/bin/sh
# The hard cases in short runs, both precisions: each holds, and what is naive fails.
. tests/checks/common.sh
need gcc gcc
for single in 0 1; do
  try gcc $c99 -O1 -DFB_SINGLE=$single -o "$out/hard" tests/hard/*.c -lm
  "$out/hard" --brief > "$out/rows_$single" 2> "$out/progress" || {
    cat "$out/progress"
    grep -B 2 -A 1 -e '^  FAIL' -e '^  NAIVE' "$out/rows_$single" || true
    fail "$(tail -n 1 "$out/rows_$single")"
  }
done
"$out/hard" --case none > "$out/log" 2>&1 && fail "--case none is taken"
ok "$(tail -n 1 "$out/rows_0"); $(tail -n 1 "$out/rows_1")"
