#!/bin/sh
# Mutation check: the equations of flexbeam_impl.h are changed one at a time (mutants.awk tells how), the tests must notice.
# sh tests/mutants/mutants.sh [SEED [COUNT]]: caught is a mutant that a test, a check of the inside against outside figures
# (tests/checks/jacobian.c, shape_rates.c) or the laws (150 models of each kind) answer by a false claim, a crash or too much time,
# or that makes tests leave an array or (where there is clang) use what nothing was written to, which check-sanitize forbids. Asked
# are those that call the function, the shortest first. Mutants that change nothing to be seen stand in equivalent.txt with the
# reason, (#2) behind the second of equal lines of a function, and count neither way; those that do not compile, or to the same code,
# are told and do not count. All are compiled into one program (switch.awk), the environment chooses. Restartable: build/mutants/caught
# is kept, survivors are tried again. On all cores (JOBS). Ends with a table by section and by kind of change, which is in
# build/mutants/table-SEED.txt, too; fails below 95 %. Sections are those of the banners.
set -eu
export LC_ALL=C
seed=${1:-1} count=${2:-200}
case $seed/$count in
  *[!0-9/]* | /* | */ | */0)
    echo "make mutants: SEED and COUNT are whole numbers, COUNT from 1 on; they are '$seed' and '$count'"
    exit 2
    ;;
esac
here=tests/mutants out=build/mutants
CC=${CC:-cc}
flags="-std=c99 -ffp-contract=off -Og -w"
sanitize="-fno-sanitize-recover=all -fsanitize"
tests="-DFBT_SHORT=1 -DFBT_STOP=1"
tab=$(printf '\t')
export here out tab CC flags tests
export ASAN_OPTIONS=detect_leaks=0 # nothing is allocated

rm -rf "$out/tree" "$out"/at-* "$out/reached"
mkdir -p "$out/tree/tests" "$out/reached"
cp flexbeam.h "$out/tree"
cp flexbeam_impl.h "$out/original.h" # what may be edited meanwhile
cp tests/*.[ch] "$out/tree/tests"
touch "$out/caught"

# tree FILE: what is compiled has this implementation
tree() { cp "$1" "$out/tree/flexbeam_impl.h"; }

# what one mutant needs, too
cat > "$out/parts.sh" << 'END'
# main FOLDER: compiles test_main.c of it
main() { (cd "$1" && $CC $flags $tests -c -o main.o tests/test_main.c 2> errors); }

# run SECONDS COMMAND...: fails by a claim, a crash or too much time of the processor
run() { (ulimit -t "$1" && shift && exec "$@" > "$out/log-$$" 2>&1) 2> "$out/crash-$$"; }

# command_of TEST: the command that runs it, a test or a check
command_of() {
  case $1 in
    laws-*) echo "$out/held ${1#laws-} --stop --count 150 --seed 1" ;;
    check-*) echo "$out/${1#check-}" ;;
    *) echo "$out/runner $1" ;;
  esac
}

# measured TEST: it passes without a mutant; what it takes and calls are lines of $out/reached/TEST "seconds TEST function"
measured() {
  REACHED=$out/reached/calls-$$ run 600 $(command_of "$1") || { cat "$out/log-$$" >&2; exit 255; }
  times > "$out/crash-$$"
  seconds=$(awk 'FNR == 2 { split($1, t, /[ms]/); print 60 * t[1] + t[2] }' "$out/crash-$$")
  sed "s|^|$seconds $1 |" "$out/reached/calls-$$" > "$out/reached/$(echo "$1" | tr / .)"
  rm "$out/reached/calls-$$"
}

# callers FUNCTION: the tests that call it with their seconds, the shortest first
callers() { awk -v name="$1" '$3 == name' "$out/reached/all"; }

# seen_by FUNCTION: prints which of those that call the function notices the mutant that the environment names; nothing
# if none does. Five times what a test takes and ten seconds is too much.
seen_by() {
  callers "$1" | while read -r seconds test name; do
    run "$(awk -v s="$seconds" 'BEGIN { print int(5 * s + 10) }')" $(command_of "$test") < /dev/null || { echo "$test"; break; }
  done
}

# same_code: the mutant compiles to what the original does
same_code() {
  at=$out/at-$MUTANT
  cp -r "$out/tree" "$at"
  text="$text" awk -v line="$line" 'NR == line { match($0, /^ */); $0 = substr($0, 1, RLENGTH) ENVIRON["text"] } { print }' \
    "$out/original.h" > "$at/flexbeam_impl.h"
  main "$at" && cmp -s "$at/main.o" "$out/original.o" && same=1 || same=0
  rm -r "$at"
  [ $same = 1 ]
}

# sanitized FUNCTION: the thirty shortest tests that call it stay within all arrays and use nothing uninitialized, as check-sanitize
# wants it (slow: survivors alone, and not those of another constant)
sanitized() {
  for program in "$out"/sanitized*; do
    for test in $(callers "$1" | sed -n '1,30s/^[^ ]* \([^ ]*\) .*/\1/p' | grep -v -E '^(check|laws)-'); do
      run 600 "$program" "$test" || return 1
    done
  done
}

END

# one LINE of $out/compiling
cat > "$out/one.sh" << 'END'
set -eu
. "$out/parts.sh"
IFS="$tab" read -r MUTANT hash kind section name line times text << LINE
$(sed -n "$1p" "$out/compiling")
LINE
export MUTANT
original=$(sed -n "${line}s/^ *//p" "$out/original.h")
text=$(printf '%s\n' "$text" | sed 's/^ *//')
key="$name | $original | $text"
by=
if grep -q -F -e "$key | " -e "$key (#$times) | " $here/equivalent.txt; then
  verdict=equivalent
elif by=$(key="$key" awk -F'\t' -v n="$times" '$3 == ENVIRON["key"] && $2 == n { print $1; found = 1 } END { exit !found }' \
  "$out/caught"); then
  verdict=caught
else
  verdict=survived
  by=$(seen_by "$name")
  if [ -z "$by" ]; then
    if same_code; then verdict=same; else [ "$kind" = factor ] || sanitized "$name" || by=sanitize; fi
  fi
  [ -z "$by" ] || {
    verdict=caught
    printf '%s\t%s\t%s\n' "$by" "$times" "$key" >> "$out/caught"
  }
fi
rm -f "$out/log-$$" "$out/crash-$$"
printf '%s %s %s: %s:%d %s: %s -> %s  (%s)\n' "$section" "$kind" "$verdict" "$section" "$line" "$name" "$original" "$text" "$by"
END
. "$out/parts.sh"

tree "$out/original.h" # test_status_detail.c has a copy of it
ls "$out"/tree/tests/test_*.c | grep -v /test_main.c | xargs -n 1 -P "${JOBS:-$(nproc)}" \
  sh -c 'exec $CC $flags $tests -c -o "$out/$(basename "$1" .c).o" "$1"' sh
MUTANT=0
main "$out/tree"
mv "$out/tree/main.o" "$out/original.o"

# in the order drawn, one kind after the other, so that all are there equally; some more than COUNT, for those passed over
awk -v seed="$seed" -f $here/mutants.awk "$out/original.h" | sort |
  awk -F'\t' '{ print ++of_kind[$2] FS $0 }' | sort -s -t "$tab" -k 1,1n | cut -f 2- |
  awk -v count="$count" 'NR <= 1.3 * count + 20 { print NR "\t" $0 }' > "$out/drawn"

# all in one program, but what does not compile
cp "$out/drawn" "$out/compiling"
for round in 1 2 3 4 5 6 7 8 9; do
  cut -f 1,6,8 "$out/compiling" > "$out/list"
  awk -v prelude=$here/switch.h -f $here/switch.awk "$out/list" "$out/original.h" > "$out/switch.h"
  tree "$out/switch.h"
  ! main "$out/tree" || break
  [ "$round" -lt 9 ] || { cat "$out/tree/errors"; exit 1; }
  sed -n 's/^[^:]*flexbeam_impl.h:\([0-9]*\):.*error.*/\1/p' "$out/tree/errors" |
    awk 'FNR == NR { wrong[$1]; next } /^\/\* mutant / { k = $3 } FNR in wrong { print k }' - "$out/switch.h" > "$out/wrong"
  awk -F'\t' 'FNR == NR { wrong[$1]; next } !($1 in wrong)' "$out/wrong" "$out/compiling" > "$out/rest"
  mv "$out/rest" "$out/compiling"
done
awk -F'\t' 'FNR == NR { compiles[$1]; next } !($1 in compiles) { print "does not compile: " $4 ":" $6 " " $5 ": " $8 }' \
  "$out/compiling" "$out/drawn" | tee "$out/not-compiling"
$CC $flags $sanitize=address,bounds $tests -o "$out/sanitized" "$out"/tree/tests/test_*.c -lm &
sanitized=$!
clang $flags -O1 $sanitize=memory $tests -o "$out/sanitized-memory" "$out"/tree/tests/test_*.c -lm 2> "$out/errors" &
memory=$!
$CC -o "$out/runner" "$out/tree/main.o" "$out"/test_*.o -lm
for check in jacobian shape_rates; do
  $CC $flags -I"$out/tree" -o "$out/$check" "tests/checks/$check.c" -lm
done
(cd "$out/tree" && echo '#include "flexbeam.h"' | $CC $flags -DFB_WITH_DETAIL=1 -DFLEXBEAM_IMPLEMENTATION -I. -c -x c - -o ../library.o)
$CC $flags -DFB_WITH_DETAIL=1 -o "$out/held" "$out/library.o" tests/laws/*.c -lm
wait "$sanitized"
wait "$memory" || rm -f "$out/sanitized-memory" # no clang
{ "$out/runner" --list && printf '%s\n' check-jacobian check-shape_rates laws-body laws-exact laws-system; } > "$out/tests"
export MUTANT
printf '. "$out/parts.sh"\nmeasured "$1"\nrm "$out/log-$$" "$out/crash-$$"\n' > "$out/measured.sh"
xargs -n 1 -P "${JOBS:-$(nproc)}" sh "$out/measured.sh" < "$out/tests"
cat "$out"/reached/* | sort -s -n > "$out/reached-by"
mv "$out/reached-by" "$out/reached/all"

# on all cores; for those that compile to the same code, which do not count, others are taken
: > "$out/results"
asked=0
drawn=$(wc -l < "$out/compiling")
while n=$(awk '$3 != "same:"' "$out/results" | wc -l) && [ "$n" -lt "$count" ] && [ "$asked" -lt "$drawn" ]; do
  more=$((asked + count - n < drawn ? count - n : drawn - asked))
  seq $((asked + 1)) $((asked + more)) | xargs -n 1 -P "${JOBS:-$(nproc)}" sh "$out/one.sh" | tee -a "$out/results"
  asked=$((asked + more))
done
[ "$n" -eq "$count" ] || echo "only $n drawn"

sections=$(sed -n 's/^   [A-Z]* >>\([a-z0-9]*\).*/\1/p' "$out/original.h" | grep -v -x -E 'config|status|version' | tr '\n' ' ')
awk -v seed="$seed" -v sections="$sections" -v wrong="$(wc -l < "$out/not-compiling")" '
  function row(s) { printf "%-10s %7d %11d %9d\n", s, of[s, "caught"], of[s, "equivalent"], of[s, "survived"] }
  function rows(title, names, n, name, i) {
    printf "%-10s %7s %11s %9s\n", title, "caught", "equivalent", "survived"
    n = split(names, name, " ")
    for (i = 1; i <= n; i++) row(name[i])
  }
  { sub(/:$/, "", $3); of[$1, $3]++; of[$2, $3]++; of["all", $3]++ }
  END {
    rows("section", sections)
    rows("kind", "sign operator factor index bound term all")
    caught = of["all", "caught"]
    counted = caught + of["all", "survived"]
    printf "%d of those drawn do not compile, %d compile to the same code\n", wrong, of["all", "same"]
    printf "seed %d: %.1f %% of %d caught\n", seed, 100 * caught / counted, counted
    exit !(caught >= 0.95 * counted)
  }' "$out/results" > "$out/table-$seed.txt" || low=1
cat "$out/table-$seed.txt"
exit ${low:-0}
