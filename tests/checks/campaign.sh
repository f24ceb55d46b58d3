#!/bin/sh
# A campaign's rows are the same bits for 1, 2, 3 processes and MPI ranks, after kill -9 in the middle, after an interrupt, from a
# torn journal, and beside runs that are refused, fail, never end, or whose process is shot. The draws: campaign.c.
. tests/checks/common.sh
need gcc gcc
need pgrep procps
campaign="build/flexbeam campaign"
quick="$out/quick.txt"
running=
trap '[ -z "$running" ] || kill -9 $running 2> /dev/null || true' EXIT

# expect STATUS COMMAND...: its output goes to $out/log
expect() {
  expected=$1
  shift
  status=0
  "$@" > "$out/log" 2>&1 || status=$?
  [ "$status" = "$expected" ] || {
    echo "$*"
    cat "$out/log"
    fail "exit status $status instead of $expected"
  }
}

# says TEXT: the last command did
says() {
  grep -qF -- "$1" "$out/log" || {
    cat "$out/log"
    fail "it does not say: $1"
  }
}

# same NAME: the rows of that run are those of the first
same() {
  cmp -s "$out/one.csv" "$out/$1.csv" || {
    diff "$out/one.csv" "$out/$1.csv" | head -n 5
    fail "$1: other rows"
  }
}

# rows NAME: rows in that journal so far
rows() {
  sed '1,/^rows /d' "$out/$1.journal" 2> /dev/null | wc -l
}

# begin NAME ROWS OPTION...: in the background, until so many rows are there
begin() {
  run=$1
  least=$2
  shift 2
  $campaign "$@" --out "$out/$run.csv" > "$out/$run.log" 2>&1 &
  running=$!
  waited=0
  while [ "$(rows $run)" -lt "$least" ]; do
    waited=$((waited + 1))
    [ $waited -lt 1000 ] || fail "$run: $least rows do not come: $(cat "$out/$run.log")"
    sleep 0.02
  done
}

# end STATUS
end() {
  status=0
  { wait $running || status=$?; } 2> /dev/null
  running=
  [ "$status" = "$1" ] || fail "$run: exit status $status instead of $1: $(cat "$out/$run.log")"
}

cat > "$out/beam.txt" << 'END'
parameter factor 1   of the stiffness
parameter force 1    N
parameter work 0.1   s of motion
duration $work
interval 0.01
step 0.001
body beam beam
  length 1
  elements 8
  stations x mass EI_y EI_z
    0 0.5 20*$factor 20*$factor
  end
  modes bend_y 2
  base prescribed
  node tip tip
end
load beam.tip dead force 0 $force 0
output tip displacement beam.tip y
measure most max tip
measure last final tip
END
cat > "$quick" << 'END'
scene beam.txt
runs 60
seed 7
vary factor list 1 2 -1 1e12 3 # the third is refused, the fourth too stiff for the step
vary force normal 1 10%
vary work uniform 0.02 2       # runs of other lengths
END

# the draws
try gcc $c99 -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all -o "$out/draws" tests/checks/campaign.c -lm
try "$out/draws"

# bodies whose beams bend far, by 20 and 37 per cent of their length: rows of the modes beside those of the exact beam
sed 's/^duration 4/duration 0.6/; /^expect/d; s/0\.4 40 40/0.4 $stiff 40/; s/^title/parameter stiff 40\ntitle/' examples/scenes/large_drop.txt > "$out/drop.txt"
printf 'scene drop.txt\nruns 4\nvary stiff list 40 20\nvary exact list 0 24\n' > "$out/far.txt"
expect 0 $campaign "$out/far.txt" --out "$out/far.csv" --pictures 0
awk -F, 'NR > 1 && $7 == "ok" { rows++; key = $2; if ($3 == 0) low[key] = $4; else { apart = low[key] / $4 - 1; well += apart < 5e-5 && apart > -5e-5 && $4 < -0.39 } }
  END { exit !(rows == 4 && well == 2) }' "$out/far.csv" || fail "large deflection: $(cat "$out/far.csv")"
build/flexbeam scene "$out/drop.txt" --set stiff=20 > "$out/log" 2>&1 || fail "the scene of large deflection: $(cat "$out/log")"
says "lowest = $(awk -F, '$2 == 20 && $3 == 0 { printf "%.9g", $4 }' "$out/far.csv")"

# 1, 2, 3 processes
expect 1 $campaign "$quick" --jobs 1 --out "$out/one.csv" --require "most above 0"
says "60 runs: 36 ok, 12 refused, 12 failed"
says "most above 0: 36 of 36 runs that are ok"
[ "$(grep -c ',refused,"[^"]*beam.txt:' "$out/one.csv")" = 12 ] || fail "refused rows do not tell the line: $(grep refused "$out/one.csv")"
[ "$(grep -c ',failed,"' "$out/one.csv")" = 12 ] || fail "failed rows have no reason"
cp "$out/log" "$out/report.txt"
for jobs in 2 3; do
  expect 1 $campaign "$quick" --jobs $jobs --out "$out/jobs$jobs.csv" --pictures 0
  same jobs$jobs
done
# what the report names is in the rows: the first run with the least of a measure, and the one with the most
ends="$(grep ',ok,' "$out/one.csv" | awk -F, '{ if (!n++ || $5 < a) { a = $5; i = $1 } if (n == 1 || $5 > b) { b = $5; k = $1 } }
  END { print i, k }')"
sed -n '/^run with the/,/^$/p' "$out/report.txt" | grep -q "^most  *${ends% *}  *${ends#* }\$" ||
  fail "the report does not name runs $ends: $(cat "$out/report.txt")"
expect 2 $campaign "$quick" --run 61
says "--run: the campaign has 60 runs"
expect 2 $campaign "$quick" --latin --runs 60
says "its value is missing: --latin"
expect 0 $campaign "$quick" --run 2
says "$(sed -n 's/^2,2,\([^,]*\),.*/\1/p' "$out/one.csv" | cut -c 1-15)"
! command -v gnuplot > /dev/null || [ -s "$out/one_scatter.svg" ] || fail "no picture"

# a run that is ok, and of which a scene warns: its row tells it, the report counts them, after a restart, too
sed 's/^step.*/step 0.01/; s/^load.*/load beam.tip dead force 0 $force 0 sine 1 $hz/; 1i parameter hz 1 Hz' "$out/beam.txt" > "$out/warned.txt"
for time in first second; do
  expect 0 $campaign --scene "$out/warned.txt" --vary "hz list 1 20 30" --set "factor 0.001" --out "$out/warned.csv" --pictures 0
  says "a warning in 2 of the runs that are ok, first in run 2: warning: the fastest that acts goes through 1.3 rad"
done
[ "$(grep -c ',ok,"warning: ' "$out/warned.csv")" = 2 ] || fail "rows do not tell of warnings: $(cat "$out/warned.csv")"
# so is one whose effects and modes, chosen by auto, are not good enough: a force that would bend the beam by six lengths
sed 's/^  modes.*/  modes bend_y 2\n  auto $factor/; s/20\*$factor/20/g; /^step/d' "$out/beam.txt" > "$out/auto.txt"
expect 0 $campaign --scene "$out/auto.txt" --vary "force list 1 400" --set "factor 0.1" --set "work 0.01" --out "$out/auto.csv" --pictures 0
says "first in run 2: auto of body beam: estimated error"
sed '1i parameter idle 1' "$out/beam.txt" > "$out/idle.txt"
expect 2 $campaign --scene "$out/idle.txt" --vary "idle list 1 2" --out "$out/idle.csv"
says "idle.txt:1: nothing uses parameter idle"

# killed, interrupted, started while it runs
begin killed 15 "$quick" --jobs 2
expect 2 $campaign "$quick" --out "$out/killed.csv"
says "another process is at work"
kill -9 $running
end 137
killed=$(rows killed)
[ "$killed" -lt 60 ] || fail "it was killed too late"
expect 1 $campaign "$quick" --jobs 2 --out "$out/killed.csv"
says " of 60 runs are in $out/killed.journal"
same killed
begin interrupted 15 "$quick" --jobs 2
kill -INT $running
end 3
grep -q 'the same command goes on' "$out/interrupted.log" || fail "an interrupt does not say how to go on"
[ "$(rows interrupted)" -lt 60 ] || fail "it was interrupted too late"
expect 1 $campaign "$quick" --out "$out/interrupted.csv"
same interrupted

# a journal with a damaged row and a torn last line
sed '20s/[0-9] \*/x */' "$out/one.journal" > "$out/torn.journal"
truncate -s -7 "$out/torn.journal"
expect 1 $campaign "$quick" --out "$out/torn.csv"
says "2 lines are torn or damaged"
same torn
expect 1 $campaign "$quick" --out "$out/torn.csv"
[ "$(rows torn)" = 62 ] || fail "a damaged row is not written once again"

# a process that is shot: one row, the others as ever; --retry mends it
long="--scene $out/beam.txt --runs 12 --jobs 2 --pictures 0"
expect 0 $campaign $long --vary "work uniform 60 70" --out "$out/long.csv"
begin shot 1 $long --vary "work uniform 60 70" # a worker that is shot has a run in hand
kill -SEGV "$(pgrep -P $running | head -n 1)"
end 1
grep -q ',crashed,"ended by signal 11"' "$out/shot.csv" || fail "no row says what became of it: $(cat "$out/shot.csv")"
[ "$(diff "$out/long.csv" "$out/shot.csv" | grep -c '^>')" = 1 ] || fail "a shot process changes other rows"
expect 0 $campaign $long --vary "work uniform 60 70" --out "$out/shot.csv" --retry
diff "$out/long.csv" "$out/shot.csv" || fail "--retry does not mend a row"
expect 1 $campaign --scene "$out/beam.txt" --vary "work list 0.1 5e4 0.2" --cpu_limit 0.5 --out "$out/limit.csv"
says "3 runs: 2 ok, 1 timed_out"

# what changes is refused or taken
expect 2 $campaign "$quick" --seed 8 --out "$out/one.csv"
says 'it says `seed 7`, this one `seed 8`'
expect 1 $campaign "$quick" --runs 80 --out "$out/killed.csv"
[ "$(head -n 61 "$out/killed.csv" | cmp - "$out/one.csv")" = "" ] || fail "more runs change the first"
mkdir "$out/other"
cp "$out/beam.txt" "$out/other"
sed '/^vary work/d' "$quick" > "$out/other/quick.txt"
begin changed 2 "$out/other/quick.txt" --set "work 20" --jobs 1
echo "# later" >> "$out/other/beam.txt"
end 2
grep -q "is not what it was" "$out/changed.log" || fail "a scene that is changed under way is not noticed"
expect 2 $campaign "$out/other/quick.txt" --set "work 20" --out "$out/changed.csv"
says 'it says `scene '

# the limit of processor time is not what makes a campaign: with another, --retry does again what met it
expect 0 $campaign --scene "$out/beam.txt" --vary "work list 0.1 2 0.2" --cpu_limit 3600 --out "$out/more.csv" --pictures 0
expect 0 $campaign --scene "$out/beam.txt" --vary "work list 0.1 2 0.2" --cpu_limit 7200 --out "$out/more.csv" --pictures 0
says "3 of 3 runs are in"

# a journal without a run, empty or torn in its head, is begun anew; one whose head is damaged is not taken for another's, nor
# is what is no journal, and they stay as they are
line=$(head -n 1 "$out/one.journal" | wc -c)
for bytes in 0 20 $((line - 1)) "$line" $((line + 20)); do
  head -c $bytes "$out/one.journal" > "$out/short.journal"
  expect 1 $campaign "$quick" --jobs 2 --out "$out/short.csv" --pictures 0
  says "$out/short.journal: ends before its first run"
  same short
done
sed '1s/journal/jornal/' "$out/one.journal" > "$out/changed.journal"
printf 'a letter\nto a friend\n' > "$out/letter.journal"
for other in changed letter; do
  cp "$out/$other.journal" "$out/kept"
  expect 2 $campaign "$quick" --out "$out/$other.csv" --pictures 0
  says "$out/$other.journal: is no journal of a campaign, or line 1 of it is damaged"
  cmp "$out/$other.journal" "$out/kept" || fail "$other: a journal that is refused was changed"
done
mkfifo "$out/pipe.journal"
mkdir "$out/folder.journal"
for other in pipe folder; do
  for fresh in "" --fresh; do
    expect 2 timeout 10 $campaign "$quick" --out "$out/$other.csv" --pictures 0 $fresh
    says "$out/$other.journal: is no file"
  done
done

# another build is another campaign
try gcc $c99 -O0 -DFB_MAX_LUMPS=9 -o "$out/other_build" -Dcampaign_main=main examples/campaign/campaign.c examples/tools/trace/untraced.c examples/tools/library.c -lm
expect 2 "$out/other_build" "$quick" --out "$out/one.csv"
says 'it says `campaign journal 1 of flexbeam'

# two at once on the same output: one does it, the other is refused, or comes later and finds it done
for round in 1 2 3 4 5 6; do
  rm -f "$out/both.csv" "$out/both.journal"
  at_once="$campaign --scene $out/beam.txt --runs 12 --vary force\ normal\ 1\ 10% --set work\ 2 --out $out/both.csv --pictures 0"
  eval "$at_once" > "$out/first.log" 2>&1 &
  running=$!
  second=0
  eval "$at_once" > "$out/second.log" 2>&1 || second=$?
  first=0
  wait $running || first=$?
  running=
  case "$first $second" in
  "0 2") refused=second ;;
  "2 0") refused=first ;;
  *) fail "two at once end with $first and $second: $(cat "$out/first.log" "$out/second.log")" ;;
  esac
  grep -q "both.journal: another process is at work on this campaign" "$out/$refused.log" ||
    fail "of two at once one does not say why it is refused: $(cat "$out/$refused.log")"
  [ "$(ls "$out" | grep -c 'both.*new')" = 0 ] || fail "two at once leave a file behind: $(ls "$out")"
  [ "$(rows both)" = 12 ] || fail "two at once: $(rows both) rows"
done

# what a parameter has no part in shows what it is correlated with
expect 0 $campaign --scene "$out/beam.txt" --runs 400 --vary "force normal 1 10%" --vary "factor normal 1 1e-6" \
  --set "work 0.02" --correlate "force factor 0.8" --out "$out/pair.csv" --pictures 0
awk '$1 == "most" && NF == 3 { r = $3 } END { exit !(r > 0.74 && r < 0.83) }' "$out/log" || # 6/pi asin(0.4) = 0.786
  fail "rank correlation of a correlated parameter: $(grep -A 2 '^rank' "$out/log")"

# more files than are watched
for k in $(seq 300); do echo "# $k" > "$out/other/file$k"; done
{ cat "$out/beam.txt"; for k in $(seq 300); do echo "input file$k file$k"; done; } > "$out/other/many.txt"
expect 2 $campaign --scene "$out/other/many.txt" --vary "force list 1 2" --out "$out/many.csv"
says "names more files than 256"

# the longest list, of numbers that are far longer in the journal than on the line
expect 0 $campaign --scene "$out/beam.txt" --vary "force list $(seq -s ' ' -f '%g/70' 256)" --out "$out/list.csv" --pictures 0
says "256 runs: 256 ok"
expect 0 $campaign --scene "$out/beam.txt" --vary "force list $(seq -s ' ' -f '%g/70' 256)" --out "$out/list.csv" --pictures 0
says "256 of 256 runs are in"

# malformed campaigns
count=0
while IFS='|' read -r lines where why; do
  printf "scene beam.txt\n$lines\n" > "$out/bad.txt"
  expect 2 $campaign "$out/bad.txt" --out "$out/bad.csv"
  says "$where: $why"
  count=$((count + 1))
done << END
vary force|bad.txt:2|how it varies must be one of normal lognormal uniform list grid, is missing
vary force gauss 1 2|bad.txt:2|how it varies must be one of
vary 1force normal 1 2|bad.txt:2|the name of a parameter
vary force normal 1|bad.txt:2|standard deviation is missing
vary force normal 1 0|bad.txt:2|the standard deviation must be greater than 0
vary force normal 1 x%%|bad.txt:2|standard deviation is not a number: x
vary force lognormal -1 1|bad.txt:2|the mean of a lognormal distribution must be greater than 0
\nvary force uniform 2 1|bad.txt:3|the lower end must be below the upper one
vary force uniform 1 2 3|bad.txt:2|too much on the line: 3
vary force list|bad.txt:2|value is missing
vary force grid 0 1 1|bad.txt:2|number of values must be a whole number from 2
vary force list 1 2\nvary force list 1|bad.txt:3|force is there twice
set force 1\nvary force list 1|bad.txt:3|force is there twice
set force|bad.txt:2|value is missing
runs 0|bad.txt:2|runs must be a whole number from 1
runs 5\nruns 6|bad.txt:3|runs is there twice
seed -1|bad.txt:2|seed must be a whole number from 0
cpu_limit 0|bad.txt:2|cpu_limit must be 0.01 to 1e6 s
spin 1|bad.txt:2|no such word for a campaign: spin
correlate force work 0.5|bad.txt:2|no parameter that varies has the name force
vary force normal 1 1\nvary work uniform 1 2\ncorrelate force work 0.5|bad.txt:4|force and work must both vary normal or lognormal
vary force normal 1 1\nvary work normal 1 2\ncorrelate force work 1|bad.txt:4|a correlation is that of two parameters, between -1 and 1
vary force normal 1 1\nvary work normal 1 2\ncorrelate force work 0.5\ncorrelate work force 0.2|bad.txt:5|work and force are correlated twice
latin\nvary force normal 1 1\nvary work normal 1 2\ncorrelate force work 0.5|bad.txt:5|correlate would take the runs out of the strata
require last beyond 1|bad.txt:2|a requirement must be one of below above, is beyond
runs 5|bad.txt|no parameter varies
vary force list 1 2 3\nruns 4|bad.txt|runs must be a multiple of 3
vary mass list 1 2 3|campaign|$out/beam.txt has no parameter: mass
vary force list 1 2\nrequire first above 1|campaign|$out/beam.txt has no measure: first
END
expect 2 $campaign --vary "force list 1 2"
says "campaign: command line: no scene is named"
expect 2 $campaign "$quick" --jobs 0
expect 2 $campaign "$quick" --jobs 1.5
says "a whole number is wanted: --jobs"
expect 2 $campaign "$quick" --run 1.5

# what is written is not what is read, nor each other
for file in "$quick" "$out/beam.txt" "$out/nothing.journal"; do
  [ ! -e "$file" ] || cp "$file" "$out/kept.txt"
  expect 2 $campaign "$quick" --out "$file" --pictures 0
  says "--out"
  [ ! -e "$file" ] || cmp "$file" "$out/kept.txt" || fail "$file was written over"
done
# a device or a folder is no place for rows, nor is a journal put beside it
ln -s /dev/null "$out/device.csv"
for file in "$out/device.csv" "$out/other"; do
  expect 2 $campaign "$quick" --out "$file" --pictures 0
  says "--out wants a file: the journal goes beside it: $file"
done
[ ! -e "$out/device.journal" ] && [ ! -e "$out/other.journal" ] || fail "a journal beside what is no file"
sed 's/^measure most/measure force/' "$out/beam.txt" > "$out/names.txt"
expect 2 $campaign --scene "$out/names.txt" --vary "force list 1 2" --out "$out/names.csv"
says "two columns of the rows would have the name: force"
expect 2 $campaign --scene "$out" --vary "force list 1 2"
[ "$(cat "$out/log")" = "campaign: the scene wants a file: it is read for every run: $out (see --help)" ] || fail "a scene that is a folder: $(cat "$out/log")"
expect 2 $campaign "$out/none.txt"
says "none.txt: No such file"

# lanes: rows are the same bits for 1, 2, 4 and 8 of them, and those of the library but for rounding; runs that are refused, too
# stiff for the step, or bend too far under way, among them
cat > "$out/arm.txt" << 'END'
parameter factor 1   of the stiffness
parameter force 1    N m
parameter rate 0.3   rad/s
parameter offset 0   m
parameter work 1     s of motion
duration $work
interval 0.05
step 0.001
body base rigid
  node 0.1 0 $offset side
end
body arm beam
  length 1
  elements 4
  stations x mass EI_y EI_z
    0 0.5 20*$factor 20*$factor
  end
  modes bend_y 2
  damping 0.01
  effects full damping
  node tip tip
end
joint turn revolute ground base
  rate 1 versine $rate 0 0.5
end
joint hinge revolute base.side arm
  stiffness 1
  damping 0.01
  motor 1 sine $force 3
end
output tip displacement arm.tip y
output angle coordinate hinge 1
output way coordinate turn 1
measure most max tip
measure last final angle
measure mean mean angle
measure effort rms angle after 0.2
measure least min way after 0.2
END
cat > "$out/lanes.txt" << 'END'
scene arm.txt
runs 90
vary factor list 1 2 -1 1e12 3
vary force list 1 200 700
vary rate uniform 0.2 0.4
END
expect 1 $campaign "$out/lanes.txt" --jobs 2 --pictures 0 --out "$out/library.csv"
says "90 runs: 18 ok, 18 refused, 54 failed"
for lanes in 1 2 4 8; do
  expect 1 $campaign "$out/lanes.txt" --jobs $((lanes % 3 + 1)) --lanes $lanes --pictures 0 --out "$out/lanes$lanes.csv"
  ! grep -q "by the library" "$out/log" || fail "$lanes lanes: $(cat "$out/log")"
  cmp "$out/lanes1.csv" "$out/lanes$lanes.csv" || fail "$lanes lanes are not the same bits as one"
done
# apart FILE FILE [LAST]: rows of two ways to compute them, numbers up to that column, 9; sets apart
apart() {
  apart=$(paste -d '|' "$1" "$2" | awk -F'|' -v c="${3:-9}" 'NR > 1 { n = split($1, a, ","); m = split($2, b, ",")
    for (k = 1; k <= c; k++) { d = a[k] == b[k] ? 0 : b[k] / a[k] - 1; most = d > most ? d : -d > most ? -d : most }
    for (k = c + 1; k <= n; k++) if (n != m || a[k] != b[k]) most = 1 } END { print most + 0 }')
}
apart "$out/library.csv" "$out/lanes1.csv"
awk "BEGIN { exit !($apart > 0 && $apart < 1e-9) }" || fail "lanes and the library differ by $apart"
first=$apart
# by_lanes SCENE STATUS COLUMNS: its rows by lanes, as SCENE_lanes.txt says, are the same bits for 1 and 4, and those of the library
# but for rounding; of bent links they are its bits
by_lanes() {
  expect $2 $campaign "$out/$1_lanes.txt" --jobs 2 --pictures 0 --out "$out/$1_library.csv"
  for lanes in 1 4; do
    expect $2 $campaign "$out/$1_lanes.txt" --jobs 1 --lanes $lanes --pictures 0 --out "$out/$1$lanes.csv"
    ! grep -q "by the library" "$out/log" || fail "$lanes lanes of $1: $(cat "$out/log")"
  done
  cmp "$out/${1}1.csv" "$out/${1}4.csv" || fail "lanes of $1 are not the same bits"
  apart "$out/$1_library.csv" "$out/${1}1.csv" $3
  awk "BEGIN { exit !($apart >= 0 && $apart < 1e-9) }" && { [ $1 = bent ] || [ "$apart" != 0 ]; } || fail "lanes of $1 and the library differ by $apart"
}
# a free body, one on a locked hinge, one on a spherical joint with a spring, and two on joints of which one axis is given
sed -e 's/^body base rigid/&\n  hub 20 0 0.01 0 2 2 3\n  node 0 0.3 0 back/' -e 's/^body arm beam/body keel rigid\n  hub 1 0 0.1 0 0.1 0.2 0.2\nend\n&/' -e '/^joint turn/,/^end/d' -e '/^parameter rate/d' -e '/^output way/d' -e '/^measure least/d' "$out/arm.txt" > "$out/free.txt"
printf 'joint bolt revolute base keel\n  mode locked\n  start 1 0.4\nend\nbody ball rigid\n  hub 1 0.1 0 0 0.02 0.03 0.04\nend\njoint socket spherical base.back ball\n  stiffness 2\n  damping 0.01\nend\n' >> "$out/free.txt"
printf 'body fin rigid\n  hub 1 0 0.2 0 0.1 0.02 0.1\nend\njoint slide cylindrical base.back fin\n  mode prescribed free\n  rate 1 versine 0.3 0 0.5\n  motor 2 constant 0.1\n  stiffness 0 5\nend\nbody tab rigid\n  hub 1 0 0.2 0 0.1 0.02 0.1\nend\njoint flap universal fin tab\n  mode free locked\n  start 1 0.2\n  start 2 0.3\n  stiffness 2 2\nend\n' >> "$out/free.txt"
printf 'output turned coordinate slide 1\noutput slid coordinate slide 2\noutput flaps coordinate flap 1\nmeasure turned final turned\nmeasure slid final slid\nmeasure flaps final flaps\n' >> "$out/free.txt"
printf 'scene free.txt\nruns 12\nvary factor list 1 2\nvary force list 1 3 200\nvary work list 0.5 0.5\n' > "$out/free_lanes.txt"
by_lanes free 1 11
# two free bodies
sed -e 's/^joint bolt revolute base keel/joint bolt free ground keel/' -e '/^  mode locked/d' -e '/^  start 1 0.4/d' "$out/free.txt" > "$out/two.txt"
sed "s/^scene .*/scene two.txt/" "$out/free_lanes.txt" > "$out/two_lanes.txt"
by_lanes two 1 11
# four bars, whose rows of the loop are chosen lane by lane; a link of it that bends far, of which modes alone are measured
cat > "$out/bars.txt" << 'END'
parameter force 1
parameter load 1
duration 0.1
step 0.002
body crank rigid
  hub $load 0.1 0 0 0.02 0.05 0.06
  node 0.3 0 0 pin
end
body link beam
  length 1
  stations x mass EI_y EI_z
    0 1.5 4000 4000
  end
  modes bend_y 1 bend_z 1
  effects full damping
  damping 0.01
  node 1 tip
end
body rocker rigid
  hub 1 0.2 0 0 0.02 0.05 0.06
  node 0.5 0 0 pin
end
joint motor revolute ground crank
  motor 1 sine $force 3
  damping 0.05
end
joint elbow revolute crank.pin link
  start 1 0.6
end
joint foot revolute ground rocker
  position 1 -0.2 0
  start 1 1.2
end
loop pin spherical link.tip rocker.pin
end
output bends mode link 1
output tip displacement link.tip y
output angle coordinate motor 1
output swing coordinate foot 1
measure most max bends
measure last final angle
measure mean mean swing
END
sed 's/effects full/effects large/' "$out/bars.txt" > "$out/bent.txt"
for scene in bars bent; do
  printf 'scene %s.txt\nruns 6\nvary force uniform 0.5 1.5\nvary load uniform 0.9 1.1\n' $scene > "$out/${scene}_lanes.txt"
  by_lanes $scene 0 6
done
sed 's/max bends/max tip/' "$out/bent.txt" > "$out/tip.txt"
expect 2 $campaign --scene "$out/tip.txt" --vary "force list 1 2" --lanes 2 --out "$out/none.csv"
says "--lanes: output tip: measure coordinates of axes, displacements, modes or strains, of effects large modes alone"
sed 's/loop pin spherical link.tip rocker.pin/loop pin revolute link.tip rocker.pin\n  mode locked/' "$out/bars.txt" > "$out/held.txt"
expect 2 $campaign --scene "$out/held.txt" --vary "force list 1 2" --lanes 2 --out "$out/none.csv"
says "--lanes: loop pin: choose mode free and no motor"
apart=$first
expect 2 $campaign "$out/lanes.txt" --lanes 4 --out "$out/library.csv"
says 'it says `measures most last mean effort least`, this one `lanes`'
expect 0 $campaign "$out/lanes.txt" --lanes 4 --run 1
says "$(sed -n 's/^1,1,1,[^,]*,\([^,]*\),.*/\1/p' "$out/lanes1.csv")"
# killed and gone on with other lanes; a process that is shot: its runs are done again, each alone
arms="--scene $out/arm.txt --runs 24 --vary rate\ uniform\ 0.2\ 0.4 --set work\ 60 --jobs 2 --pictures 0"
eval "expect 0 $campaign $arms --lanes 2 --out '$out/arms.csv'"
eval "begin half 3 $arms --lanes 4"
kill -9 $running
end 137
[ "$(rows half)" -lt 24 ] || fail "lanes are killed too late"
eval "expect 0 $campaign $arms --lanes 8 --out '$out/half.csv'"
cmp "$out/arms.csv" "$out/half.csv" || fail "lanes after kill -9: other rows"
eval "begin hit 1 $arms --lanes 4"
kill -SEGV "$(pgrep -P $running | head -n 1)"
end 0
cmp "$out/arms.csv" "$out/hit.csv" || fail "lanes after a process was shot: other rows"
# more than numbers varies: another number of modes
sed -e 's/^parameter offset.*/&\nparameter count 2 of modes/' -e 's/modes bend_y 2/modes bend_y $count/' "$out/arm.txt" > "$out/count.txt"
expect 0 $campaign --scene "$out/count.txt" --vary "count list 2 1" --lanes 2 --out "$out/form.csv" --pictures 0
says "1 runs went by the library, not by lanes"
# what cannot go by lanes
expect 2 $campaign "$quick" --lanes 2 --out "$out/none.csv"
says "--lanes: one body without a joint"
sed 's/^output angle coordinate/output angle speed/' "$out/arm.txt" > "$out/speed.txt"
expect 2 $campaign --scene "$out/speed.txt" --vary "force list 1 2" --lanes 2 --out "$out/none.csv"
says "--lanes: output angle: measure coordinates of axes, displacements"
expect 2 env CC=/no/compiler $campaign "$out/lanes.txt" --lanes 2 --out "$out/none.csv"
says "--lanes: gcc or clang is wanted for its equations (CC=/no/compiler)"
expect 2 $campaign "$out/lanes.txt" --lanes 3
says "1, 2, 4 or 8 is wanted"
[ ! -e "$out/none.csv" ] || fail "lanes that cannot be leave rows"

# MPI
mpi="MPI not looked at: no mpicc (apt-get install openmpi-bin libopenmpi-dev)"
if command -v mpicc > /dev/null && command -v mpirun > /dev/null; then
  run_mpi="mpirun --allow-run-as-root --oversubscribe"
  try mpicc $c99 -fsyntax-only examples/campaign/campaign_mpi.c
  for ranks in 1 2 3; do
    expect 1 $run_mpi -n $ranks build/examples/campaign_mpi "$quick" --out "$out/mpi$ranks.csv" --pictures 0
    same mpi$ranks
  done
  sed '30,$d' "$out/one.journal" > "$out/passed_on.journal"
  expect 1 $run_mpi -n 2 build/examples/campaign_mpi "$quick" --out "$out/passed_on.csv" --pictures 0
  same passed_on
  expect 1 $run_mpi -n 2 build/examples/campaign_mpi --scene "$out/beam.txt" --vary "work list 0.1 5e4 0.2" --cpu_limit 0.5 \
    --out "$out/mpi_limit.csv" --pictures 0
  cmp -s "$out/limit.csv" "$out/mpi_limit.csv" || fail "MPI: other rows with a run that does not end"
  expect 2 $run_mpi -n 2 build/examples/campaign_mpi "$out/bad.txt" --out "$out/bad.csv"
  expect 2 $run_mpi -n 1 build/examples/campaign_mpi "$quick" --run 2 --out "$out/bad.csv"
  says "no such option: the program campaign has it: --run"
  expect 2 $run_mpi -n 1 build/examples/campaign_mpi "$quick" --jobs 2 --out "$out/bad.csv"
  says "no such option: mpirun -n N says how many runs at a time: --jobs"
  mpi="1, 2, 3 MPI ranks the same"
fi
ok "1, 2, 3 processes the same bits; 1, 2, 4, 8 lanes, too, apart from the library by $apart; killed at row $killed, interrupted, torn, shot; $mpi; $count malformed files refused"
