#!/bin/sh
# A program that cannot write all that it prints, or a file, does not end well: every example, and every word of build/flexbeam,
# into a disk that is full; what an earlier run wrote stays, then and when a signal comes. A word that there is not is refused.
. tests/checks/common.sh
bin=build/examples
words=" $(build/flexbeam --help | sed -n 's/^  \([a-z0-9]*\) .*/\1/p' | tr '\n' ' ')"

# run PROGRAM OPTION...: an example, or a word of build/flexbeam
run() {
  case "$words" in
  *" $1 "*) build/flexbeam "$@" ;;
  *)
    of=$bin/$1
    [ "$1" != flexbeam ] || of=build/flexbeam
    shift
    "$of" "$@"
    ;;
  esac
}
ln -s /dev/full "$out/full.csv"
printf 'parameter force 1\nduration 1\nbody b rigid\n  hub 1  0 0 0  1 1 1\nend\nload b dead force $force 0 0\n' > "$out/push.txt"
printf 'output v velocity b x\nmeasure v final v\n' >> "$out/push.txt"
printed=0
filed=0

# unprinted PROGRAM OPTION...: into a full disk it says so, and its exit status is 1; it does end well without
unprinted() {
  program=$1
  shift
  status=0
  run $program "$@" > /dev/full 2> "$out/log" || status=$?
  [ $status = 1 ] && grep -q "^$program: cannot write all of the standard output: No space left on device\$" "$out/log" || {
    cat "$out/log"
    fail "$program $* > /dev/full: exit status $status"
  }
  try run $program "$@"
  printed=$((printed + 1))
}

# unfiled NAME PROGRAM OPTION...: that file is on a full disk
unfiled() {
  file=$1
  program=$2
  shift 2
  status=0
  run $program "$@" > "$out/printed" 2> "$out/log" || status=$?
  [ $status != 0 ] && grep -q "^$program: .*$file" "$out/log" || {
    cat "$out/log"
    fail "$program $*: exit status $status"
  }
  filed=$((filed + 1))
}

for program in $(basename -s .c examples/*.c examples/*/*.c); do
  case $program in
  quickstart | tutorial_*) # they have no header but the library's: they are the first texts that somebody reads
    ! "$bin/$program" > /dev/full || fail "$program > /dev/full ends well"
    try "$bin/$program"
    printed=$((printed + 1))
    ;;
  assembly | firmware) unprinted $program ;;
  campaign_mpi) ;; # mpirun has its standard output
  fmu2 | fmu3 | library | flexbeam_scene) ;; # no programs: they go into FMUs, the tool, and a shared library
  first_curve) ;; # tests/checks/python.sh
  *) unprinted $program --help ;;
  esac
done
status=0
build/flexbeam reduc > "$out/printed" 2> "$out/log" || status=$?
[ $status = 2 ] && grep -q 'unknown word: reduc$' "$out/log" && grep -q '^  reduce ' "$out/log" && [ ! -s "$out/printed" ] ||
  fail "flexbeam reduc: exit status $status"
# results, more than a buffer of them, and pictures
unprinted scene examples/scenes/double_pendulum.txt
unprinted campaign --scene "$out/push.txt" --vary "force list 1 2" --out "$out/top.csv" --pictures 0 --fresh
unprinted reduce examples/boom.txt
unprinted analyse examples/boom.txt
unprinted exact examples/bend45.txt
unprinted scene examples/scenes/rotating_beam.txt --campbell eta 0 1 2
unprinted elastica --out "$out/elastica.csv"
unprinted hil_plant --simulated-time direct --seconds 0.1 --out "$out/hil.csv"
full=$out/full.csv
unfiled full.csv elastica --out "$full"
unfiled full.csv follower --out "$full"
unfiled full.csv exact examples/bend45.txt --out "$full"
unfiled full.csv flap --seconds 0.05 --out "$full"
unfiled full.csv whirl --seconds 0.4 --ramp 0.1 --out "$full"
unfiled full.csv reduce examples/boom.txt --out "$full"
unfiled full.csv arm --move 0.5 --out "$full"
unfiled full.csv hil_plant --simulated-time direct --seconds 0.1 --out "$full"
unfiled full.csv spacecraft --t-end 60 --out "$full"
unfiled full.csv scene examples/scenes/top.txt --picture "$full"
unfiled full.csv scene examples/scenes/top.txt --animation "$full"
unfiled full.csv scene examples/scenes/top.txt --linear "$full"
unfiled full.csv scene examples/scenes/rotating_beam.txt --campbell eta 0 1 2 --out "$full"
unfiled full.csv analyse examples/boom.txt --linear "$full"
# torn FILE PROGRAM OPTION...: where FILE has room for no more than a block, what an earlier run wrote stays as it was, and
# the message says where the new one is
torn() {
  file=$out/$1
  program=$2
  shift 2
  echo "of an earlier run" > "$file"
  status=0
  told=$(trap '' XFSZ && ulimit -f 1 && run $program "$@" 2>&1) || status=$?
  echo "$told" > "$out/log"
  [ $status != 0 ] && [ "$(cat "$file")" = "of an earlier run" ] && [ -s "$file.part" ] &&
    grep -q "^$program: .*$file: File too large; what is written of it is $file.part\$" "$out/log" || {
    cat "$out/log"
    fail "$program $*: exit status $status, $file begins with $(head -n 1 "$file")"
  }
  rm "$file" "$file.part"
  filed=$((filed + 1))
}
torn z.csv scene examples/scenes/top.txt --out "$out/z.csv"
torn z.svg scene examples/scenes/top.txt --picture "$out/z.svg"
torn z.svg scene examples/scenes/top.txt --animation "$out/z.svg"
torn z.json scene examples/scenes/rotor.txt --linear "$out/z.json"
torn z.csv scene examples/scenes/satellite_control.txt --margins "$out/z.csv"
torn z.h scene examples/scenes/double_pendulum.txt --code "$out/z.h"
torn z.json analyse examples/boom.txt --linear "$out/z.json"
torn z.h reduce examples/boom.txt --out "$out/z.h"
torn z.csv elastica --out "$out/z.csv"
torn z.csv exact examples/bend45.txt --out "$out/z.csv"
torn z.csv hil_plant --simulated-time direct --seconds 0.1 --out "$out/z.csv"
torn z.csv spacecraft --t-end 60 --out "$out/z.csv"
try build/flexbeam campaign --scene "$out/push.txt" --vary "force uniform 1 2" --runs 60 --out "$out/z.csv" --pictures 0
torn z.csv campaign --scene "$out/push.txt" --vary "force uniform 1 2" --runs 60 --out "$out/z.csv" --pictures 0
# terminated FILE PROGRAM OPTION...: it says where the new one is, too
terminated() {
  file=$out/$1
  shift
  echo "of an earlier run" > "$file"
  "$@" > "$out/printed" 2> "$out/log" &
  running=$!
  for wait in $(seq 1000); do
    [ ! -s "$file.part" ] || break
    sleep 0.02
  done
  kill $running
  status=0
  wait $running || status=$?
  [ $status = 143 ] && [ "$(cat "$file")" = "of an earlier run" ] && [ -s "$file.part" ] &&
    grep -q ": .*what is written .* is $file.part\$" "$out/log" || {
    cat "$out/log"
    fail "$*, terminated: exit status $status"
  }
  rm "$file" "$file.part"
}
sed 's/^duration .*/duration 1e6/; s/^step .*/step 0.01/; /^reference/d; /^expect/d' examples/scenes/top.txt > "$out/long.txt"
terminated z.csv build/flexbeam scene "$out/long.txt" --quiet --out "$out/z.csv"
# an FMU that is not packed yet leaves no folder
mkdir "$out/packing"
echo "of an earlier run" > "$out/packing/z.fmu"
printf '#!/bin/sh\n: > "%s/compiling"\nexec sleep 100\n' "$PWD/$out" > "$out/slow_cc"
chmod +x "$out/slow_cc"
CC=$PWD/$out/slow_cc build/flexbeam fmu examples/boom.txt --out "$out/packing/z.fmu" > "$out/log" 2>&1 &
running=$!
for wait in $(seq 1000); do
  [ ! -e "$out/compiling" ] || break
  sleep 0.02
done
kill $running
status=0
wait $running || status=$?
[ $status = 143 ] && [ "$(ls "$out/packing")" = z.fmu ] && [ "$(cat "$out/packing/z.fmu")" = "of an earlier run" ] || {
  cat "$out/log"
  fail "an export that is terminated: exit status $status, $(ls "$out/packing")"
}
# pipes are not waited for where a text is read more than once, nor by gnuplot
mkfifo "$out/pipe"
status=0
timeout 10 build/flexbeam fmu "$out/pipe" --out "$out/pipe.fmu" > "$out/log" 2>&1 || status=$?
[ $status = 2 ] && grep -q "read more than once: $out/pipe" "$out/log" || fail "an FMU of a pipe: exit status $status"
status=0
timeout 10 build/flexbeam campaign --scene "$out/pipe" --vary "force list 1 2" --out "$out/pipe.csv" > "$out/log" 2>&1 || status=$?
[ $status = 2 ] && grep -q "read for every run: $out/pipe" "$out/log" || fail "a campaign of a pipe: exit status $status"
cat "$out/pipe" > "$out/read.csv" &
try timeout 20 "$bin/hil_plant" --simulated-time direct --seconds 0.1 --out "$out/pipe"
wait $!
[ "$(wc -l < "$out/read.csv")" = 101 ] || fail "who reads a pipe gets $(wc -l < "$out/read.csv") rows"
terminated z.csv "$bin/spacecraft" --t-end 10000 --out "$out/z.csv"
ok "$printed runs into a full standard output and $filed into a full file are told"
