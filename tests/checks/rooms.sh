#!/bin/sh
# The rooms of the implementation: RUN compiles alone, RUN and BUILD compile without ANALYSE, each with and without systems
# and the exact beam, without a warning and without a function that nothing uses; no section uses one that stands below it;
# the list in each banner is what its code uses; what is removed is not declared.
. tests/checks/common.sh
need gcc gcc
need g++ g++
need clang clang
need clang++ clang
awk -f tests/checks/rooms.awk flexbeam_impl.h > "$out/arrows"
[ ! -s "$out/arrows" ] || { cat "$out/arrows"; fail "banners"; }
sections() { sed -n 's/^   \([A-Z]* >>[a-z0-9]*\).*/\1/p' "$1"; }
[ "$(sections flexbeam.h)" = "$(sections flexbeam_impl.h)" ] ||
  fail "flexbeam.h and flexbeam_impl.h have other sections, or another order"

count=0
# look COMPILER OPTIONS...: no warning; clang tells of unused functions from the syntax alone
look() {
  try "$@" $options -DFB_SINGLE=$single -fsyntax-only "$out/impl.c"
  count=$((count + 1))
}

# BUILD and ANALYSE, systems, exact beams, precision, a variant: every pair of two of them is in a row
while read -r rooms system exact single variant; do
  options="-DFB_WITH_SYSTEM=$system -DFB_WITH_EXACT=$exact -DFB_WITH_BUILD=${rooms%?} -DFB_WITH_ANALYSE=${rooms#?} -D$variant"
  look clang $c99
  look gcc $c99
  look clang++ -std=c++11 $base -x c++
  look g++ -std=c++11 $base -x c++
done << END
00 1 1 0 FB_WITH_FORMS=0
00 0 0 1 FLEXBEAM_STATIC
00 1 0 1 FB_WITH_FORMS=0
00 1 0 0 FB_WITH_DETAIL=1
10 1 1 0 FB_WITH_FORMS=0
10 1 1 1 FLEXBEAM_STATIC
10 0 1 0 FB_WITH_FORMS=1
10 0 0 0 FB_WITH_DETAIL=1
11 0 0 1 FB_WITH_FORMS=0
11 1 1 0 FLEXBEAM_STATIC
11 1 0 1 FB_WITH_FORMS=1
11 0 1 1 FB_WITH_DETAIL=1
END
for rooms in 0000 1100 1110 1111; do
  set -- $(echo $rooms | sed 's/./& /g')
  try gcc $c99 -O0 -DFB_WITH_SYSTEM=$1 -DFB_WITH_EXACT=$2 -DFB_WITH_BUILD=$3 -DFB_WITH_ANALYSE=$4 -c -o "$out/$rooms.o" "$out/impl.c"
  count=$((count + 1))
done
# one body keeps its analysis without systems
for single in 0 1; do
  for system in 1 0; do
    try gcc $c99 -O0 -DFB_SINGLE=$single -DFB_WITH_SYSTEM=$system -DFB_WITH_EXACT=$system -o "$out/one_body" tests/checks/one_body.c -lm
    try "$out/one_body"
    cp "$out/log" "$out/one_body$system"
  done
  cmp "$out/one_body0" "$out/one_body1" || fail "steady state, linear model or spectrum of one body differ without systems"
done
gcc $c99 -DFB_WITH_ANALYSE=1 -DFB_WITH_BUILD=0 -fsyntax-only "$out/impl.c" 2> "$out/log" && fail "ANALYSE without BUILD is taken"
grep -q 'FB_WITH_ANALYSE needs FB_WITH_BUILD' "$out/log" || fail "no word on FB_WITH_ANALYSE without FB_WITH_BUILD"
gcc $c99 -DFB_WITH_DETAIL=2 -fsyntax-only "$out/impl.c" 2> "$out/log" && fail "FB_WITH_DETAIL=2 is taken"
grep -q 'FB_WITH_DETAIL is 0 or 1' "$out/log" || fail "no word on FB_WITH_DETAIL=2"
nm "$out/1111.o" | grep -i -e fb_detail -e fbi_detail -e fbi_refuse && fail "records of refusals without FB_WITH_DETAIL"
# the functions that a step runs, as the comment above fb_rk4_step lists them
sed -n '/WHAT A STEP OF ONE BODY RUNS/,/\*\//p' flexbeam_impl.h | sed -n 's/^     \(fbi*_[A-Za-z0-9_]*\): \(.*[a-z_]\).*/\1 \2/p' | sed 's/ \*$//' > "$out/tree"
[ "$(wc -l < "$out/tree")" -ge 10 ] || fail "WHAT A STEP OF ONE BODY RUNS is not found"
while read -r caller callees; do
  awk -v start="[ *]$caller\\(" '/^(static|FB_DEF)/ && $0 ~ start { on = 1 } on { print } /^}/ { on = 0 }' flexbeam_impl.h > "$out/function"
  for callee in $callees; do
    grep -q "[^a-zA-Z0-9_]$callee(" "$out/function" || fail "WHAT A STEP OF ONE BODY RUNS: $caller does not call $callee"
  done
done < "$out/tree"
# what a step of one body runs with all effects compiled in: functions that -O0 leaves, their lines without comments
need valgrind valgrind
sed 's/^#define FB_WITH_OPTIONAL 0.*//' examples/quickstart.c > "$out/step.c"
try gcc -std=c99 -I. -O0 -o "$out/step" "$out/step.c" -lm
try valgrind --tool=callgrind --callgrind-out-file="$out/step.calls" --toggle-collect=fb_rk4_step "$out/step"
grep -E '^c?fn=\([0-9]+\) ' "$out/step.calls" | sed 's/.*) //' | grep -E '^fbi?_' | sort -u > "$out/step.functions"
awk 'NR == FNR { runs[$1] = 1; next }
     /^(static|FB_DEF)/ { match($0, /fbi?_[a-zA-Z0-9_]*\(/); name = substr($0, RSTART, RLENGTH - 1); on = name in runs; n = 0 }
     on && NF && !/^ *(\/\*|#)/ { n++ }
     /^}/ && on { lines += n; on = 0 }
     END { print lines }' "$out/step.functions" flexbeam_impl.h > "$out/step.lines"
step="$(wc -l < "$out/step.functions") functions, $(cat "$out/step.lines") lines"
[ "$(wc -l < "$out/step.functions")" -le 120 ] && [ "$(cat "$out/step.lines")" -le 1600 ] ||
  fail "a step of one body runs $step; 120, 1600 at most"
exported() { nm -g --defined-only "$out/$1.o" | grep -c ' T fb_'; }
nm -g --defined-only "$out/0000.o" | grep -E ' T fb_(system|exact|eig|beam|modes|shape|advi|[a-z_]*_init$)' | grep -vE "fb_(state|stepper)_init" &&
  fail "functions of a removed room are still there"
printf '#define FB_WITH_BUILD 0\n#include "flexbeam.h"\nint main(void) { return fb_shape_init(0, 0); }\n' > "$out/undeclared.c"
gcc -std=c99 -I. -Werror -fsyntax-only "$out/undeclared.c" 2> "$out/log" && fail "fb_shape_init is declared without BUILD"
ok "$count compilations, every pair of options in one; functions exported: RUN of one body $(exported 0000), with systems and exact beams $(exported 1100), with BUILD $(exported 1110), with ANALYSE $(exported 1111); a step of one body runs $step; $(grep -c '^   [A-Z]* >>' flexbeam_impl.h) sections, each uses those above it as its banner says"
