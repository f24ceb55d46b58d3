#!/bin/sh
# One bit flipped in a model, an integrator or a state: tests/checks/faults.c, under the address and undefined-behavior
# sanitizers, in one precision by day. Each is detected, gives a status, or leaves finite results.
. tests/checks/common.sh
need gcc gcc
result=
for single in $(turn 1 0); do
  library=build/sanitized/$([ $single = 1 ] && echo single || echo double).o # of make
  try gcc -fsanitize=address,undefined -fno-sanitize-recover=all $c99 -O1 -DFB_SINGLE=$single -DFLEXBEAM_IMPL_INCLUDED \
    -o "$out/faults" tests/checks/faults.c "$library" -lm
  "$out/faults" > "$out/table$single.txt" 2>&1 || {
    cat "$out/table$single.txt"
    fail "FB_SINGLE=$single: the above"
  }
  result="$result, $(awk 'NR > 1 { n += $3; d += $4; s += $5; h += $6 } END { print n " flips: " d " detected, " s " statuses, " h " harmless" }' "$out/table$single.txt")"
done
cat "$out"/table?.txt
ok "${result#, } ($([ $single = 1 ] && echo single || echo double)), no crash, nothing that is not finite"
