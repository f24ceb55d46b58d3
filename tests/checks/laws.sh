# Laws that every model keeps, held against random ones, in both precisions: by a seed of its own every day, LAWS_COUNT
# models of each kind (300). Single follows double: what became of each model after a short run, to a share of the motion.
. tests/checks/common.sh

count=${LAWS_COUNT:-300}
seed=${LAWS_SEED:-$(($(date +%s) / 86400))}
single_count=$((count < 100 ? count : 100)) # it is asked less
exact=1e-3 # bounds of exact beams, of the length or of the energy that bends a beam by its length; of others, of the size
others=2e-4
failed=""

held() { # held PROGRAM KIND COUNT SEED: runs the laws; what failed is printed with its reproducer
  log=$out/$(basename "$1")_$2.txt
  "$1" "$2" --count "$3" --seed "$4" > "$log" || {
    grep -A 5 '^FAIL' "$log" || true
    failed="$failed $2"
  }
  echo "$(basename "$1" | sed 's/laws/double/; s/double_single/single/') $2 $(tail -n 1 "$log")" >> "$out/figures"
}

held build/laws body "$count" "$seed"
held build/laws system "$count" "$seed"
held build/laws exact "$count" "$seed"
held build/laws_single body "$single_count" "$seed" # of the other kinds the digests tell

for p in laws laws_single; do
  build/$p --digest --count "$count" --seed "$seed" > "$out/$p.digest"
done

# Lines of the same model; the numbers end at `done,` or `refused:`. Single precision may refuse a few more.
awk -v exact="$exact" -v others="$others" '
  { end = 0; for (i = 4; i <= NF && !end; i++) { end = $i == "done," || $i == "refused:" ? i : 0 } model = $1 " " $2 " " $3 }
  FNR == NR { double[model] = $0; count[model] = $end == "done," ? end : 0; next }
  { models++
    if (!(model in double)) { print "not there in double precision: " model; bad++; next }
    if (!count[model] || $end != "done,") { refused += ($end == "done,") != (count[model] > 0); next }
    split(double[model], other)
    if (end != count[model]) { print "other numbers: " model; bad++; next }
    for (i = 4; i < end; i++) {
      off = $i - other[i]; off = off < 0 ? -off : off; worst = off > worst ? off : worst
      if (!(off <= ($1 == "exact" ? exact : others))) { print model ": " other[i] " in double, " $i " in single precision; levels " $NF; bad++; break }
    } }
  END { print models + 0, worst + 0 > "/dev/stderr"
        if (refused > 0.05 * models) { print refused " of " models " refused in one precision alone"; bad++ }
        exit bad > 0 }' "$out/laws.digest" "$out/laws_single.digest" > "$out/differ" 2> "$out/worst" || {
  cat "$out/differ"
  failed="$failed single_follows_double"
}

figures=$(tr '\n' ';' < "$out/figures" | sed 's/;/; /g')
[ -z "$failed" ] || fail "seed $seed:$failed; ${figures}single precision: $(cat "$out/worst")"
ok "seed $seed, ${figures}single precision after $(sed 's/ .*//' "$out/worst") short runs: within $(sed 's/.* //' "$out/worst")"
