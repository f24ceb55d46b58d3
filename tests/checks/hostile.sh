#!/bin/sh
# Every public function bears hostile arguments: tests/checks/hostile.c says which and what must come of them. Under the
# address and undefined-behavior sanitizers, in one precision by day's turn. A function of the header without an entry fails.
. tests/checks/common.sh
need gcc gcc
sed -n 's/^FB_API .*[ *]\(fb_[a-zA-Z0-9_]*\)(.*/\1/p' flexbeam.h | sort > "$out/header"
result=
for single in $(turn 1 0); do
  library=build/sanitized/$([ $single = 1 ] && echo single || echo double).o # of make
  try gcc -fsanitize=address,undefined -fno-sanitize-recover=all $c99 -O1 -DFB_SINGLE=$single -DFLEXBEAM_IMPL_INCLUDED \
    -o "$out/hostile" tests/checks/hostile.c "$library" -lm
  "$out/hostile" > "$out/calls" 2>&1 || {
    grep -v '^fb_[a-zA-Z0-9_]* [0-9]*$' "$out/calls" | head -n 40
    fail "FB_SINGLE=$single: the above"
  }
  cut -d ' ' -f 1 "$out/calls" | sed 's/_of_lines$//; s/_of_rotors$//; s/_of_orbits$//' | sort -u > "$out/called"
  cmp -s "$out/header" "$out/called" || {
    diff "$out/header" "$out/called"
    fail "functions of the header (<) and those called here (>) differ"
  }
  result="$result, $(awk '{ calls += $2 } END { print NR " functions, " calls " calls" }' "$out/calls") in $([ $single = 1 ] && echo single || echo double)"
done
ok "${result#, }: NULL is refused, nothing else crashes, changes what a failure must not, or gives what is not finite"
