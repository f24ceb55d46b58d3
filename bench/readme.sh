#!/bin/sh
# Regenerates the tables, the program and the pictures of the documents from what the programs print: make readme.
# Some parts alone: `sh bench/readme.sh PART...`, the names of functions below; the table of `peers` stays as it is where the
# libraries that it compares with are missing. A table goes to the one document that has its two marks, of which the first then
# says the commit that was measured: HEAD, so that what is measured has to be committed. With TABLES=FOLDER tables go to files
# there instead, and the documents stay as they are.
set -eu
out=build/readme
mkdir -p "$out"
. tests/checks/documents.inc

if [ -n "${TABLES:-}" ]; then
  mkdir -p "$TABLES"
else
  git diff --quiet HEAD -- . ':!*.md' ':!*.svg' || {
    echo "readme: tables say the commit that was measured; commit what differs from HEAD first" >&2
    exit 1
  }
  measured=$(git rev-parse --short=7 HEAD)
fi

# block NAME [COMMIT]: standard input becomes the table NAME, measured at COMMIT, else at HEAD
block() {
  if [ -n "${TABLES:-}" ]; then
    cat > "$TABLES/$1"
    return
  fi
  cat > "$out/block"
  document=$(document_of "$1") || document=
  [ -f "$document" ] || { # none, or more than one
    echo "readme: the mark of $1 stands in: ${document:-no document}" >&2
    exit 1
  }
  awk -v name="$1" -v file="$out/block" -v commit="${2:-$measured}" '
    $0 == "<!-- /" name " -->" { while ((getline line < file) > 0) print line; skip = 0 }
    index($0, "<!-- " name " commit=") == 1 { sub(/commit=[^ ]*/, "commit=" commit); print; skip = 1 }
    !skip { print }' "$document" > "$out/new"
  cp "$out/new" "$document"
}

# picture FILE NAME: gnuplot's, beside what makes it; the old one stays where gnuplot is missing
picture() {
  [ ! -f "$1" ] || [ -n "${TABLES:-}" ] || sed 's/ *$//' "$1" > "$2"
}

peers() {
  if make -s bench-peers > "$out/peers"; then
    picture build/peers/peers.svg bench/peers.svg
    { echo '```'; sed 's/ *$//' "$out/peers"; echo '```'; } | block peers
  else
    cat "$out/peers"
  fi
}

hil() { # a minute of it; how late it woke is in the report
  make -s hil > "$out/hil" || true
  { echo '```'; sed -e '/^curves/d' -e '/^picture/d' -e '/refused, .* 0$/d' -e 's/ *$//' "$out/hil"; echo '```'; } | block hil
}

campaign() { # its pictures' names are those of the folder
  make -s campaign > "$out/campaign" 2> /dev/null
  { echo '```'; sed -e '/^picture/d' -e 's/ *$//' "$out/campaign"; echo '```'; } | block campaign
}

speedup() {
  make -s bench-campaign > "$out/speedup"
  { echo '```'; cat "$out/speedup"; echo '```'; } | block speedup
}

# The command line's answers for a boom, without those for 10 %.
advise() {
  make -s build/flexbeam
  build/flexbeam advise --simulate > "$out/advise"
  { echo '```'; sed -e '/^10 %: [A-Z]/,/^$/d' -e 's/ *$//' "$out/advise"; echo '```'; } | block advise
}

flags() {
  make -s bench-flags > "$out/flags"
  { echo '```'; sed 's/ *$//' "$out/flags"; echo '```'; } | block flags
}

accuracy() {
  make -s bench-accuracy > "$out/scenes" || true # what is missed stands in the table
  { echo '```'; sed -e 's/^# //' -e 's/ *$//' build/accuracy/tables.txt; echo '```'; } | block scenes
  { echo '```'; sed -n '/^scene  /,$p' build/accuracy/tables.txt; echo '```'; } | block ratios
  picture build/accuracy/accuracy.svg bench/accuracy.svg
}

# The eight scenes as they are, and the count of all.
advice() {
  make -s bench-advice > "$out/advice"
  awk '/, varied$/ { skip = 1 } /^[a-z]/ && !/, varied$/ { skip = 0 } !skip' "$out/advice" > "$out/advised"
  { echo '```'; sed -e 's/^# //' -e 's/ *$//' "$out/advised"; echo '```'; } | block advice
}

# The hard cases, the figures of both precisions in a row: which is the first field of the CSV, texts are the even ones
# between quotes. A value that differs in single precision stands behind a bar.
hard() {
  make -s hard > "$out/hard"
  awk -F'"' '
    function number(x) { return x ~ /[in]/ || x + 0 > 1e18 ? "diverges" : sprintf("%.2g", x) }
    function both(k, what) { d = v[0, k, what]; s = v[1, k, what]; return d == "" ? s : s == "" || s == d ? d : d " / " s }
    BEGIN { print "| case | how hard | steps, time [s], periods | what holds | double: figure, bound, margin | single | naive treatment | gives |"
            print "|---|---|---|---|---|---|---|---|" }
    NR > 1 {
      p = $1 ~ /single/; k = $2 "/" ++count[p, $2]
      if (!(k in name)) { name[k] = $2; row[++rows] = k; text[k] = $4; degree[k] = $6; measure[k] = $8; naive[k] = $10 }
      split($7, run, ","); split($9, held, ","); split($11, gives, ",")
      for (i = 3; i <= 5; i++) run[i] = run[i] > 0 ? sprintf("%.3g", run[i]) : "-"
      v[p, k, "hard"] = sprintf("%.3g", run[2]); v[p, k, "run"] = run[3] ", " run[4] ", " run[5]
      v[p, k, "held"] = number(held[2]) ", " number(held[3]) ", " (held[4] ~ /inf/ ? "-" : number(held[4]))
      v[p, k, "gives"] = number(gives[2])
    }
    END { for (i = 1; i <= rows; i++) { k = row[i]
      print "| " name[k] ": " text[k] " | " degree[k] " " both(k, "hard") " | " both(k, "run") " | " measure[k] " | " v[0, k, "held"] \
        " | " v[1, k, "held"] " | " naive[k] " | " both(k, "gives") " |" } }' build/hard.csv | block hard
}

coverage() {
  CHECK_ALL=1 make -s check-coverage > "$out/coverage" || true # where it is below its bound the table says so
  { echo '```'; cat build/coverage/table.txt; echo '```'; } | block coverage
}

# SEEDS, that nobody wrote tests for, together; half an hour each: not in the list below.
mutants() {
  seeds=${SEEDS:-1 2 3}
  for seed in $seeds; do
    make -s mutants SEED="$seed" > "$out/mutants-$seed" || true
  done
  {
    echo '```'
    awk '
      /^section/ || /^kind/ { heading[++rows] = $0; next }
      /^seed/ { print_seed[++seeds] = $0; next }
      NF == 4 { if (!($1 in of)) { row[++rows] = $1 } of[$1]++; for (i = 2; i <= 4; i++) { sum[$1, i] += $i } }
      END {
        for (k = 1; k <= rows; k++) {
          if (k in heading) { if (!said[heading[k]]++) print heading[k] }
          else printf "%-10s %7d %11d %9d\n", row[k], sum[row[k], 2], sum[row[k], 3], sum[row[k], 4]
        }
        for (k = 1; k <= seeds; k++) print print_seed[k]
        n = sum["all", 2] + sum["all", 4]
        printf "together: %.1f %% of %d caught\n", 100 * sum["all", 2] / n, n
      }' $(printf 'build/mutants/table-%s.txt ' $seeds)
    echo '```'
  } | block mutants
  noticed
}

# What the laws notice alone of what flies, by SEED: hours, not in the list below.
alone() {
  make -s mutants-laws SEED="${SEED:-1}" > "$out/alone" || true
  { echo '```'; cat "build/mutants/laws-${SEED:-1}.txt"; echo '```'; } | block alone
}

# Of the mutants the sentence of README.md.
noticed() {
  caught=$(table_of mutants | sed -n 's/^together: \(.*\) caught$/\1/p')
  commit=$(commit_of mutants)
  echo "The tests and the laws notice $caught random changes of equations, after tests for what first survived, of the library at commit $commit." | block noticed "$commit"
}

# Of each scene its title and the largest relative difference from what it is compared with.
scene() {
  make -s build/flexbeam
  for file in examples/scenes/*.txt; do
    build/flexbeam scene "$file" | awk -v name="$(basename "$file" .txt)" -v title="$(sed -n 's/^title //p' "$file")" -f bench/scene.awk
  done > "$out/scenes"
  { echo '```'; cat "$out/scenes"; echo '```'; } | block scene
  build/flexbeam scene examples/scenes/double_pendulum.txt --quiet --picture examples/scene/scene_pendulum.svg
}

hostile() {
  CHECK_ALL=1 make -s check-hostile > "$out/calls"
  sed -e 's/^ok *hostile: /Calls of `check-hostile`: /' -e 's/: NULL is refused.*/./' "$out/calls" | block hostile
}

# Flips of check-faults; double precision before a bar, single behind it.
faults() {
  CHECK_ALL=1 make -s check-faults CFLAGS='-O2 -Werror' > "$out/faults"
  awk '
    FNR == 1 { table++; next }
    { for (i = 2; i <= 8; i++) cell[$1, i] = table == 1 ? $i : cell[$1, i] " / " $i }
    table == 1 { row[++rows] = $1 }
    END { print "| struct | bits | flips | detected | a status | finite | not finite | by check word |"
          print "|---|---:|---:|---:|---:|---:|---:|---:|"
          for (k = 1; k <= rows; k++) { line = "| `" row[k] "`"
            for (i = 2; i <= 8; i++) line = line " | " cell[row[k], i]
            print line " |" } }' build/checks/faults/table0.txt build/checks/faults/table1.txt | block faults
}

# Figures of the tests, double and single side by side.
figures() {
  make -s build/readme/figures_double build/readme/figures_single > "$out/log"
  build/readme/figures_double --figures > "$out/double"
  build/readme/figures_single --figures > "$out/single"
  awk -F'|' '
    BEGIN { print "| case | against | double | single | test |"; print "|---|---|---|---|---|" }
    FNR == NR { single[$1, $2] = $3; next }
    { print "| " $1 " | " $2 " | " $3 " | " (($1, $2) in single ? single[$1, $2] : "") " | " $4 " |" }' \
    "$out/single" "$out/double" | block figures
  summary
}

# Of the figures the rows that README.md shows, in this order.
summary() {
  table_of figures > "$out/figures"
  sed -n 1,2p "$out/figures" | cut -d '|' -f 1-5 | sed 's/$/|/' > "$out/summary"
  while read -r row; do
    grep -F "| $row |" "$out/figures" | head -n 1 | cut -d '|' -f 1-5 | sed 's/$/|/' | grep . >> "$out/summary" || {
      echo "readme: no figure: $row" >&2
      exit 1
    }
  done << ROWS
cantilever, first three frequencies
Timoshenko beams, six frequencies
rotating cantilever, first flap and lag, eta 0..12
accelerations, n = 1..8, normalized and general M
accelerations of 8 sets of effects
spin-up, tip deflection of 3 modes / peak
energy, momentum form
tumbling, 1e6 steps, angular momentum
free asymmetric top
rigid blade on hinges, flap, lag and pitch
elastica, dead and follower tip loads to 20 EI/L^2, 40 elements, of the length
Beck's flutter load, 20 elements, relative
ROWS
  block summary "$(commit_of figures)" < "$out/summary"
}

# The program of README.md, between ```c and ```, the first one.
program() {
  sed -n '/^#/,$p' examples/quickstart.c > "$out/program"
  awk -v file="$out/program" '
    /^```$/ { if (skip) { while ((getline line < file) > 0) print line } skip = 0 }
    !skip { print }
    /^```c$/ && !found { skip = found = 1 }' README.md > "$out/new"
  cp "$out/new" README.md
}

# The spin-up: its table, what README.md shows of it, and the picture beside the example.
spinup() {
  make -s build/examples/spinup
  build/examples/spinup --reference tests/reference/p07C_second_order.csv --out build/spinup.csv > "$out/spinup"
  { echo '```'; sed -n -e 's/ *$//' -e '/^Spin-up/,/^ *6 .*large/p' "$out/spinup"; echo '```'; } | block spinup
  ladder
  picture build/spinup.svg examples/papers/spinup.svg
}

# Of the spin-up no mode, one mode and three.
ladder() {
  table_of spinup | sed -e '/^ *[26]  /d' -e '/half an effect/d' | block ladder "$(commit_of spinup)"
}

# The forms of the equations of motion.
forms() {
  make -s build/bench/bench_forms_double
  build/bench/bench_forms_double > "$out/forms"
  { echo '```'; awk -F, '!/^#/ { printf "%-10s %8s %3s %9s %8s %8s %16s %15s\n", $1, $2, $3, $4, $5, $6, $7, $8 }' "$out/forms"; echo '```'; } |
    block forms
}

# What accuracy costs in time.
table1() {
  make -s table1 > "$out/table1"
  { echo '```'; sed -n -e 's/ *$//' -e '/^Accuracy/,/^torque.*converged/p' "$out/table1"; echo '```'; } | block accuracy
  { echo '```'; sed -n -e 's/ *$//' -e '/^Table 1/,$p' "$out/table1"; echo '```'; } | block table1
}

# Systems: time per step, and the slew of a spacecraft.
system() {
  make -s build/bench/bench_system_double build/examples/spacecraft
  build/bench/bench_system_double > "$out/system"
  { echo '```'; awk -F, -f bench/system.awk "$out/system" | sed 's/ *$//'; echo '```'; } | block system
  build/examples/spacecraft --out build/spacecraft.csv > "$out/spacecraft"
  picture build/spacecraft_error.svg examples/spacecraft_error.svg
}

# The geometrically exact beam: time, the tables of [L], two pictures.
exact() {
  make -s build/bench/bench_exact_double build/examples/elastica build/examples/follower
  build/bench/bench_exact_double > "$out/exact"
  { echo '```'; awk -F, -f bench/exact.awk "$out/exact" | sed 's/ *$//'; echo '```'; } | block exact
  build/examples/elastica --out build/elastica.csv > "$out/elastica"
  picture build/elastica.svg examples/elastica.svg
  build/examples/follower --out build/follower.csv > "$out/follower"
  picture build/follower_flutter.svg examples/follower_flutter.svg
}

leigh() {
  make -s leigh > "$out/leigh"
  { echo '```'; sed -n -e 's/ *$//' -e '/^Table 4.4/,/^4.7, 4.8/p' "$out/leigh" | sed '$d'; tail -n 1 "$out/leigh"; echo '```'; } | block leigh
}

# The blade: its frequencies, and ElastoDyn's from the head of the table.
blade() {
  make -s build/flexbeam
  table=tests/reference/nrel5mw_blade.csv
  build/flexbeam scene examples/scenes/nrel_blade.txt --campbell rpm 0 12.1 2 | awk -F, '
    NR == 1 { for (k = 3; k < NF; k += 2) { split($k, word, " "); kind[k] = word[1]; number[k] = word[2] } next }
    { for (k = 3; k < NF; k += 2) printf "%s,%s,%s,%.12g\n", $2, kind[k], number[k], sqrt($k ^ 2 + $(k + 1) ^ 2) }' > "$out/blade"
  {
    echo '```'
    awk -F, '
      BEGIN { pi = atan2(0, -1); print "mode       rpm      here  ElastoDyn  difference  without softening" }
      FNR == NR { if (/flap 1 [0-9.]+ [0-9.]+ ;/) { gsub(/[#;(,]/, " "); n = split($0, w, " ")
                    for (i = 1; i + 3 <= n; i++) if (w[i] == "flap" || w[i] == "edge") {
                      kind = w[i] == "edge" ? "lag" : "flap"; figure[kind, w[i + 1], 0] = w[i + 2]; figure[kind, w[i + 1], 1] = w[i + 3] } }
                  next }
      ($2, $3, 0) in figure { turning = $1 > 0; f = figure[$2, $3, turning]; hz = $4 / (2 * pi); spin = $1 / (2 * pi)
        printf "%-4s %d  %7.1f  %8.4f   %8.4f   %8.2f %%", $2 == "lag" ? "edge" : "flap", $3, 60 * spin, hz, f, 100 * (hz / f - 1)
        if (turning && $2 == "lag") printf "  %8.2f %%", 100 * (hz / sqrt(f * f - spin * spin) - 1)
        print "" }' $table "$out/blade"
    echo '```'
  } | block blade
  make -s blade 2> "$out/campbell"
  picture build/campbell.svg examples/tools/campbell.svg
}

# How much of a beam its modes hold.
identities() {
  make -s build/bench/identities_double
  build/bench/identities_double > "$out/identities"
  { echo '```'; cat "$out/identities"; echo '```'; } | block identities
}

instructions() { # the table is printed before the verdict
  CHECK_ALL=1 make -s check-instructions > "$out/instructions" || true
  { echo '```'; sed -e '/^ok/d' -e '/^FAIL/d' -e 's/ *$//' "$out/instructions"; echo '```'; } | block instructions
}

single() {
  make -s check-single > "$out/single_precision" || true
  { echo '```'; sed -e '/^ok/d' -e '/^FAIL/d' "$out/single_precision"; echo '```'; } | block single
}

sizes() {
  make -s build/flexbeam
  { echo '```'; sh bench/sizes.sh; echo '```'; } | block sizes
  flight
}

# Of the report of the firmware's check: the flight image by both steps.
firmware() {
  make -s check-firmware > "$out/firmware"
  {
    echo '```'
    echo "step                  flags  precision  code  constants  RAM with stack  instructions"
    tr ';' '\n' < "$out/firmware" | awk '{ gsub(/,/, "") }
      $3 == "code" { own = sub(/^generated_/, "", $1)
        printf "%-20s  %-5s  %-9s %5d  %9d  %14d  %12d\n", own ? "of reduce --code" : "of the library", $2, $1, $4, $6, $8, $10 }'
    echo '```'
  } | block firmware
}

# Of the report of the check of generated steps.
code() {
  CHECK_ALL=1 make -s check-code > "$out/code"
  { echo '```'; sed -n -e 's/^ok *code: //p' "$out/code" | sed -e 's/; /\n  /g' -e 's/, \([0-9]* [a-z0-9]\)/\n  \1/g'; echo '```'; } | block code
}

compile() {
  make -s build/flexbeam
  { echo '```'; sh bench/compile.sh; echo '```'; } | block compile
}

aero() {
  make -s build/examples/wing_goland build/examples/ground_resonance build/examples/rotor_flight
  {
    echo '```'
    for program in wing_goland ground_resonance rotor_flight; do
      [ $program = wing_goland ] || echo
      build/examples/$program --out "$out/$program.csv" | grep -v -e '^curves' -e '^picture'
    done
    echo '```'
  } | block aero
}

# Of the sizes the rows of six modes on a Cortex-M4F.
flight() {
  { echo '```'; table_of sizes | grep -E '^precision +modes +effects|^single +6 +[a-z]'; echo '```'; } | block flight "$(commit_of sizes)"
}

if [ $# -gt 0 ]; then # these parts alone
  for part in "$@"; do
    "$part"
  done
  exit
fi
for part in hil accuracy advice advise flags hard campaign speedup scene hostile faults coverage program figures spinup forms table1 system \
  exact leigh blade identities peers instructions single sizes compile aero firmware code; do
  "$part"
done
echo "tables, program and pictures of the documents regenerated"
