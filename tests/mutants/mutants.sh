#!/bin/sh
# Mutation check: the equations of flexbeam_impl.h are changed one at a time (mutants.awk tells how), the tests must notice.
# sh tests/mutants/mutants.sh [SEED [COUNT]]: caught is a mutant that a test, or a check of the inside against outside figures
# (tests/checks/jacobian.c, shape_rates.c), answers by a false claim, a crash or too much time. Those that change nothing to be
# seen stand in equivalent.txt with the reason and count neither way; those that do not compile, or to the same code, are
# passed over. Restartable: build/mutants/caught is kept, survivors are tried again. Ends with a table by section, which is
# in build/mutants/table-SEED.txt, too; fails below 95 %.
set -eu
export LC_ALL=C
seed=${1:-1} count=${2:-200}
here=tests/mutants out=build/mutants
CC=${CC:-cc}
flags="-std=c99 -ffp-contract=off -Og -w"
tests="-DFBT_SHORT=1 -DFBT_STOP=1"
tab=$(printf '\t')
# cheap ones first
sections="vec3 rotation linalg build status advise analyse integrate forms body system modes mixed beam"

mkdir -p "$out/tree/tests"
cp flexbeam.h flexbeam_impl.h "$out/tree"
cp flexbeam_impl.h "$out/original.h" # what may be edited meanwhile
cp tests/fbt.h tests/test_main.c "$out/tree/tests"
touch "$out/caught"

build_main() { $CC $flags $tests -c -o "$1" "$out/tree/tests/test_main.c" 2> "$out/errors"; }

# run COMMAND...: fails by a claim, a crash or too much time (of the processor: five times what the longest suite takes)
run() { (ulimit -t 40 && exec "$@" > "$out/log" 2>&1) 2> "$out/crash"; }

# seen_by SECTION: prints which suite or check notices the mutant that is in the tree; nothing if none does
seen_by() {
  $CC -o "$out/runner" "$out/main.o" "$out"/test_*.o -lm
  for suite in $1 $(echo $sections | tr ' ' '\n' | grep -v "^$1\$"); do
    run "$out/runner" "$suite/" || { echo "$suite"; return; }
  done
  for check in jacobian shape_rates; do
    $CC $flags -I"$out/tree" -o "$out/check" "tests/checks/$check.c" -lm && run "$out/check" || { echo "check-$check"; return; }
  done
}

for file in tests/test_*.c; do
  [ $file = tests/test_main.c ] || $CC $flags $tests -c -o "$out/$(basename "$file" .c).o" "$file"
done
build_main "$out/original.o"
$CC -o "$out/runner" "$out/original.o" "$out"/test_*.o -lm
run "$out/runner" || { cat "$out/log"; exit 1; } # without a mutant they pass

# in the order drawn, one kind after the other, so that all are there equally
awk -v seed="$seed" -f $here/mutants.awk "$out/original.h" | sort |
  awk -F'\t' '{ print ++of_kind[$2] FS $0 }' | sort -s -t "$tab" -k 1,1n | cut -f 2- > "$out/drawn"

: > "$out/results"
n=0
while [ "$n" -lt "$count" ] && IFS="$tab" read -r hash kind section name line times text; do
  original=$(sed -n "${line}s/^ *//p" "$out/original.h")
  text=$(printf '%s\n' "$text" | sed 's/^ *//')
  key="$name | $original | $text"
  by=
  if grep -q -F -e "$key | " $here/equivalent.txt; then
    verdict=equivalent
  elif by=$(key="$key" awk -F'\t' -v n="$times" '$3 == ENVIRON["key"] && $2 == n { print $1; found = 1 } END { exit !found }' \
    "$out/caught"); then
    verdict=caught
  else
    text="$text" awk -v line="$line" 'NR == line { match($0, /^ */); $0 = substr($0, 1, RLENGTH) ENVIRON["text"] } { print }' \
      "$out/original.h" > "$out/tree/flexbeam_impl.h"
    build_main "$out/main.o" || continue
    ! cmp -s "$out/main.o" "$out/original.o" || continue
    by=$(seen_by "$section")
    verdict=$([ -n "$by" ] && echo caught || echo survived)
    [ -z "$by" ] || printf '%s\t%s\t%s\n' "$by" "$times" "$key" >> "$out/caught"
  fi
  n=$((n + 1))
  printf '%s %s\n' "$section" "$verdict" >> "$out/results"
  printf '%3d/%d %-10s %-8s %s:%d %s: %s -> %s  (%s)\n' \
    "$n" "$count" "$verdict" "$kind" "$section" "$line" "$name" "$original" "$text" "$by"
done < "$out/drawn"

awk -v seed="$seed" '
  function row(s) { printf "%-10s %7d %11d %9d\n", s, of[s, "caught"], of[s, "equivalent"], of[s, "survived"] }
  { of[$1, $2]++; of["all", $2]++ }
  END {
    printf "%-10s %7s %11s %9s\n", "section", "caught", "equivalent", "survived"
    n = split("vec3 rotation linalg beam modes body system mixed integrate analyse advise all", section, " ")
    for (i = 1; i <= n; i++) row(section[i])
    caught = of["all", "caught"]
    counted = caught + of["all", "survived"]
    printf "seed %d: %.1f %% of %d caught\n", seed, 100 * caught / counted, counted
    exit !(caught >= 0.95 * counted)
  }' "$out/results" > "$out/table-$seed.txt" || low=1
cat "$out/table-$seed.txt"
exit ${low:-0}
