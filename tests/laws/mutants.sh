#!/bin/sh
# What the laws notice on their own: equations of RUN are changed one at a time, as tests/mutants/mutants.sh does for the tests,
# and build/laws is asked, in processes of its own on all cores. sh tests/laws/mutants.sh [SEED [COUNT [MODELS]]]: MODELS of each
# kind are drawn for each mutant, of the kinds that run through its function; a mutant that none does survives. Survivors are asked
# once more with a tenth of the models under a sanitizer, which notices what leaves an array. Those of tests/mutants/equivalent.txt
# count neither way. Ends with a table by section, which is in build/mutants/laws-SEED.txt, too; fails below 95 %.
set -eu
export LC_ALL=C
seed=${1:-1} count=${2:-200} models=${3:-150}
out=build/mutants/laws here=tests/mutants tab=$(printf '\t')
CC=${CC:-cc}
flags="-std=c99 -ffp-contract=off -O1 -w -DFB_WITH_DETAIL=1"
sanitize="-fno-sanitize-recover=all -fsanitize=address,bounds"
mkdir -p "$out/tree"
cp flexbeam.h "$out/tree"
cp flexbeam_impl.h "$out/original.h"

# in the order drawn, one kind of change after the other
run='^(vec3|rotation|solve|line|body|system|exact|integrate)$'
awk -v seed="$seed" -f $here/mutants.awk "$out/original.h" | sort | awk -F'\t' -v run="$run" '$3 ~ run' |
  awk -F'\t' '{ print ++of_kind[$2] FS $0 }' | sort -s -t "$tab" -k 1,1n | cut -f 2- |
  awk -v count="$count" 'NR <= count { print NR "\t" $0 }' > "$out/drawn"
cut -f 1,6,8 "$out/drawn" > "$out/list"
awk -v prelude=$here/switch.h -f $here/switch.awk "$out/list" "$out/original.h" > "$out/tree/flexbeam_impl.h"
(cd "$out/tree" && echo '#include "flexbeam.h"' | $CC $flags -DFLEXBEAM_IMPLEMENTATION -I. -c -x c - -o ../library.o)
$CC $flags -o "$out/laws" "$out/library.o" tests/laws/*.c -lm
(cd "$out/tree" && echo '#include "flexbeam.h"' | $CC $flags $sanitize -DFLEXBEAM_IMPLEMENTATION -I. -c -x c - -o ../library-sanitized.o)
$CC $flags $sanitize -o "$out/laws-sanitized" "$out/library-sanitized.o" tests/laws/*.c -lm
for kind in body exact system; do # without a mutant they hold
  REACHED=$out/reached-$kind "$out/laws" $kind --count "$models" --seed "$seed" > "$out/plain" || { cat "$out/plain"; exit 1; }
done

# one MUTANT: a line "section kind verdict: the change (law)"
cat > "$out/one.sh" << 'END'
line=$(sed -n "$1p" "$out/drawn") v=survived by='not reached'
name=$(printf '%s\n' "$line" | cut -f 5) was=$(sed -n "$(printf '%s\n' "$line" | cut -f 6)s/^ *//p" "$out/original.h")
now=$(printf '%s\n' "$line" | cut -f 8 | sed 's/^ *//')
times=$(printf '%s\n' "$line" | cut -f 7)
! grep -q -F -e "$name | $was | $now | " -e "$name | $was | $now (#$times) | " tests/mutants/equivalent.txt || v=equivalent
ask() { (ulimit -t 900; MUTANT=$1 exec "$2" "$3" --stop --count "$4" --seed "$seed") > "$out/log-$1" 2>&1; }
for program in laws laws-sanitized; do
  for kind in body exact system; do
    if [ $v = survived ] && grep -q -x "$name" "$out/reached-$kind"; then
      n=$models by=
      [ $program = laws ] || n=$((models / 10 + 1))
      ask "$1" "$out/$program" $kind "$n" || { v=caught by=$(sed -n 's/^FAIL //p' "$out/log-$1" | cut -d' ' -f1,2 | head -n 1); }
    fi
  done
done
printf '%s\n' "$line" | awk -F'\t' -v v="$v" -v by="$by" '{ sub(/^ */, "", $8); print $4, $3, v ": " $5 ":" $6 " " $8 "  (" by ")" }'
rm -f "$out/log-$1"
END
export out models seed
cut -f 1 "$out/drawn" | xargs -n 1 -P "${JOBS:-$(nproc)}" sh "$out/one.sh" | tee "$out/results"

awk -v seed="$seed" '{ of[$1, $3]++; of["all", $3]++; seen[$1] }
  function row(s) { printf "%-10s %7d %9d\n", s, of[s, "caught:"], of[s, "survived:"] }
  END { printf "%-10s %7s %9s\n", "section", "caught", "survived"
        for (s in seen) row(s)
        row("all")
        n = of["all", "caught:"] + of["all", "survived:"]
        printf "seed %d: the laws notice %.1f %% of %d\n", seed, 100 * of["all", "caught:"] / n, n
        exit of["all", "caught:"] < 0.95 * n }' "$out/results" > "build/mutants/laws-$seed.txt" || low=1
cat "build/mutants/laws-$seed.txt"
exit ${low:-0}
