#!/bin/sh
# Every public function bears hostile arguments: tests/checks/hostile.c says which and what must come of them. Under the
# address and undefined-behavior sanitizers, in both precisions, in double with FB_WITH_FORMS, which leaves out nothing. A function of
# the header without an entry fails.
. tests/checks/common.sh
need gcc gcc
sed -n 's/^FB_API .*[ *]\(fb_[a-zA-Z0-9_]*\)(.*/\1/p' flexbeam.h | sort > "$out/header"
result=
for build in "1 0" "0 1"; do # FB_SINGLE, FB_WITH_FORMS
  set -- $build
  library=build/sanitized/$([ $1 = 1 ] && echo single || echo forms).o # of make
  try gcc -fsanitize=address,undefined -fno-sanitize-recover=all $c99 -O1 -DFB_SINGLE=$1 -DFB_WITH_FORMS=$2 -DFLEXBEAM_IMPL_INCLUDED \
    -o "$out/hostile" tests/checks/hostile.c "$library" -lm
  "$out/hostile" > "$out/calls" 2>&1 || {
    grep -v '^fb_[a-zA-Z0-9_]* [0-9]*$' "$out/calls" | head -n 40
    fail "FB_SINGLE=$1, FB_WITH_FORMS=$2: the above"
  }
  cut -d ' ' -f 1 "$out/calls" | sed 's/_of_lines$//; s/_of_rotors$//; s/_of_orbits$//' | sort -u > "$out/called"
  cmp -s "$out/header" "$out/called" || {
    diff "$out/header" "$out/called"
    fail "functions of the header (<) and those called here (>) differ"
  }
  result="$result, $(awk '{ calls += $2 } END { print NR " functions, " calls " calls" }' "$out/calls") in $([ $1 = 1 ] && echo single || echo double)$([ $2 = 0 ] || echo " with all forms")"
done
ok "${result#, }: NULL is refused, nothing else crashes, changes what a failure must not, or gives what is not finite"
