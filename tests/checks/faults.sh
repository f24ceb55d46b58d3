#!/bin/sh
# One bit flipped in a model, an integrator or a state: tests/checks/faults.c, under the address and undefined-behavior
# sanitizers, in both precisions, in double with FB_WITH_FORMS, which leaves out nothing. Each is detected, gives a status, or leaves finite results.
. tests/checks/common.sh
need gcc gcc
result=
for build in "1 0" "0 1"; do # FB_SINGLE, FB_WITH_FORMS
  set -- $build
  library=build/sanitized/$([ $1 = 1 ] && echo single || echo forms).o # of make
  try gcc -fsanitize=address,undefined -fno-sanitize-recover=all $c99 -O1 -DFB_SINGLE=$1 -DFB_WITH_FORMS=$2 -DFLEXBEAM_IMPL_INCLUDED \
    -o "$out/faults" tests/checks/faults.c "$library" -lm
  "$out/faults" > "$out/table$1$2.txt" 2>&1 || {
    cat "$out/table$1$2.txt"
    fail "FB_SINGLE=$1, FB_WITH_FORMS=$2: the above"
  }
  result="$result, $(awk 'NR > 1 { n += $3; d += $4; s += $5; h += $6 } END { print n " flips: " d " detected, " s " statuses, " h " harmless" }' "$out/table$1$2.txt")"
done
cat "$out/table01.txt"
ok "${result#, } (single, double with all forms), no crash, nothing that is not finite"
