#!/bin/sh
# Hardware in the loop: the bytes of the packets and their tag, also on a big-endian machine; lock-step gives the same bits as
# a controller that is called, a stranger without the key beside it or not; a plant among malformed, forged, repeated and late
# packets refuses each for its reason, and moves as without them; another key is told on both sides; a controller that crashes
# in the slew trips the watchdog, the next one recovers the pointing; a run in real time (how late it wakes is the machine's:
# not judged, its budget of lateness is far beyond); one whose plant is stopped ends by that budget, safely; one whose
# controller is stopped is safe meanwhile.
. tests/checks/common.sh
need gcc gcc
need qemu-mips qemu-user
need mips-linux-gnu-gcc "gcc-mips-linux-gnu libc6-dev-mips-cross"
plant=build/examples/hil_plant
controller="build/examples/hil_controller --priority 0"
running=
trap 'kill $running 2> /dev/null || true' EXIT
HIL_KEY=$(od -An -N16 -tx1 /dev/urandom | tr -d ' \n')
export HIL_KEY
other_key=$(echo "$HIL_KEY" | tr 0123456789abcdef 123456789abcdef0)

# begin NAME OPTION...: a plant on a free port
begin() {
  run=$1
  shift
  : > "$out/$run.txt"
  "$plant" --port 0 --priority 0 --out "$out/$run.csv" "$@" > "$out/$run.txt" 2>&1 &
  plant_id=$!
  running=$plant_id
  waited=0
  port=
  while [ -z "$port" ]; do
    port=$(sed -n 's/^hil_plant: 127.0.0.1, port //p' "$out/$run.txt")
    waited=$((waited + 1))
    [ $waited -lt 200 ] || fail "$run: the plant does not start: $(cat "$out/$run.txt")"
    [ -n "$port" ] || sleep 0.1
  done
}

# end STATUS...: the plant ends by itself, with one of these
end() {
  status=0
  wait $plant_id || status=$?
  running=
  case " $* " in *" $status "*) ;; *)
    cat "$out/$run.txt"
    fail "$run: the plant's exit status is $status"
    ;;
  esac
}

digest() {
  sed -n 's/^  digest of all states: //p' "$out/$1.txt"
}

# figure NAME PATTERN: the number before PATTERN in that run's report
figure() {
  sed -n "s/.* \([0-9]*\) $2.*/\1/p" "$out/$1.txt"
}

# refused NAME REASON: how many
refused() {
  sed -n "s/^  refused, $2  *//p" "$out/$1.txt"
}

sanitize="-O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all"
try gcc $c99 $sanitize -o "$out/hil" tests/checks/hil.c -lm
try "$out/hil"
try mips-linux-gnu-gcc $c99 -O2 -static -o "$out/hil_mips" tests/checks/hil.c -lm
try qemu-mips "$out/hil_mips"

# More steps seem slow than there is room for: none of those that are not repeated counts as slow.
try gcc $c99 -O1 -o "$out/suspects" -DFLEXBEAM_IMPL_INCLUDED tests/checks/hil_suspects.c build/library/double.o -lm
try "$out/suspects"

try "$plant" --simulated-time direct --seconds 30 --out "$out/direct.csv"
mv "$out/log" "$out/direct.txt"
! "$plant" --simulated-time direct --seconds 30 --out "$out/none/direct.csv" > "$out/log" 2>&1 || fail "wrote where it cannot"
grep -q "cannot write" "$out/log" && ! grep -q "pointing" "$out/log" || { cat "$out/log"; fail "--out is refused after the run"; }
begin lock_step --simulated-time lock-step --seconds 30
try $controller --port "$port"
end 0
cmp -s "$out/direct.csv" "$out/lock_step.csv" || fail "lock-step and direct: other curves"
[ "$(digest direct)" = "$(digest lock_step)" ] || fail "lock-step and direct: other digests"

# A stranger without the key, who was there before the controller: he commanded for as long as he wanted to.
begin stranger --simulated-time lock-step --seconds 30
"$out/hil" "$port" stranger &
stranger=$!
running="$running $stranger"
try sleep 1
try $controller --port "$port"
kill $stranger
wait $stranger 2> /dev/null || true
end 0
[ "$(digest direct)" = "$(digest stranger)" ] || fail "a stranger has moved the plant"
grep -q "hil_plant: somebody says hello who has another key: refused" "$out/stranger.txt" || fail "the plant does not tell of a stranger"
strangers=$(refused stranger "not signed by this key")
[ "$strangers" -ge 100 ] || fail "a stranger's packets are not counted: $strangers"

# Another key: both sides say so, the controller before its patience ends, and the plant waits on for the right one.
begin other_key --simulated-time lock-step --seconds 1
status=0
HIL_KEY=$other_key timeout 20 $controller --port "$port" > "$out/log" 2>&1 || status=$?
[ $status = 1 ] && grep -q "hil_controller: what answers at port $port has another key: refused" "$out/log" || {
  cat "$out/log"
  fail "another key: the controller's exit status is $status"
}
try $controller --port "$port"
end 0
grep -q "hil_plant: somebody says hello who has another key: refused" "$out/other_key.txt" || fail "the plant does not tell of another key"

# Keys: from a file that others cannot read, made where none is named, or told why not.
# no_key REASON OPTION...
no_key() {
  reason=$1
  shift
  status=0
  (unset HIL_KEY && cd "$out" && timeout 20 "$top/$plant" --port 0 "$@") > "$out/log" 2>&1 || status=$?
  [ $status = 2 ] && grep -qF "hil_plant: the key: $reason" "$out/log" || {
    cat "$out/log"
    fail "$*: status $status, expected: $reason"
  }
}
top=$(pwd)
printf '%s\n' "$HIL_KEY" > "$out/open.key"
chmod 640 "$out/open.key"
no_key "others may read or write its file" --key open.key
printf '%s\n' "$HIL_KEY" | cut -c 2- > "$out/short.key"
chmod 600 "$out/short.key"
no_key "is no line of 32 hexadecimal digits" --key short.key
no_key "cannot be read: none.key" --key none.key
no_key "cannot be read: none.key" --simulated-time direct --seconds 1 --key none.key
mkfifo "$out/pipe.key"
no_key "cannot be read: pipe.key" --key pipe.key
HIL_KEY=abc "$plant" --port 0 --out "$out/none.csv" > "$out/log" 2>&1 && fail "a plant starts without a key"
grep -q "HIL_KEY wants 32 hexadecimal digits" "$out/log" || fail "a bad HIL_KEY is not told"
given=$HIL_KEY
unset HIL_KEY
plant="$top/$plant" out="$top/$out"
mkdir "$out/keyless"
cd "$out/keyless"
begin made --simulated-time lock-step --seconds 1
try "$top"/$controller --port "$port"
end 0
cd "$top"
[ "$(stat -c %a "$out/keyless/hil.key")" = 600 ] && [ "$(ls -A "$out/keyless")" = hil.key ] ||
  fail "the key that is made: $(ls -lA "$out/keyless")"
HIL_KEY=$given
export HIL_KEY

# A repeated answer, where this machine made the plant ask twice, is the one refusal that the clock can add.
begin alone --simulated-time lock-step --seconds 10 --patience 0.5
"$out/hil" "$port" alone > "$out/undisturbed" || fail "the sender of good packets"
try $controller --port "$port"
end 0
begin malformed --simulated-time lock-step --seconds 10 --patience 0.5
"$out/hil" "$port" attack > "$out/expected" || fail "the sender of malformed packets"
try $controller --port "$port"
end 0
grep -q '^sensors ' "$out/undisturbed" && [ "$(cat "$out/undisturbed")" = "$(grep '^sensors ' "$out/expected")" ] ||
  fail "malformed packets move the plant: $(cat "$out/undisturbed" "$out/expected")"
grep '^  refused, ' "$out/malformed.txt" | grep -v 'old or repeated' > "$out/refused"
grep '^  refused, ' "$out/expected" | grep -v 'old or repeated' | cmp -s - "$out/refused" || {
  cat "$out/expected" "$out/malformed.txt"
  fail "not every malformed packet is refused for its reason"
}
grep '^  refused, ' "$out/expected" | grep -q ' 0$' && fail "a reason that no packet tried: $(cat "$out/expected")"
repeated="s/^  refused, old or repeated  *//p"
[ "$(sed -n "$repeated" "$out/malformed.txt")" -ge "$(sed -n "$repeated" "$out/expected")" ] || fail "repeated packets are taken"

begin crash --simulated-time lock-step --patience 0.5
! $controller --port "$port" --crash-at 10 > "$out/log" 2>&1 || fail "the controller did not crash"
try $controller --port "$port"
end 0
for run in malformed crash; do
  [ "$(figure $run trips)" -ge 1 ] || fail "$run: the watchdog did not trip"
  [ "$(figure $run trips)" = "$(figure $run recoveries)" ] || fail "$run: trips and recoveries differ"
done

begin real_time --seconds 2 --late-ms 60000
try $controller --port "$port"
end 0 1
grep -q '^2000 periods of 1 ms' "$out/real_time.txt" || fail "real time: $(cat "$out/real_time.txt")"
grep -q 'angular momentum.* ok$' "$out/real_time.txt" || fail "real time: $(cat "$out/real_time.txt")"

# comes: the controller is there, and half a second of the run
comes() {
  $controller --port "$port" > "$out/$run.log" 2>&1 &
  controller_id=$!
  running="$running $controller_id"
  waited=0
  while ! grep -q '^hil_plant: a controller has come' "$out/$run.txt"; do
    waited=$((waited + 1))
    [ $waited -lt 200 ] || fail "$run: no controller comes: $(cat "$out/$run.txt" "$out/$run.log")"
    sleep 0.1
  done
  sleep 0.5
}

# A plant that stood still for 2.5 s does not catch up as if nothing had been, but ends, safe.
begin stopped --seconds 60 --late-ms 1000
comes
kill -STOP $plant_id
sleep 2.5
kill -CONT $plant_id
end 1
wait $controller_id || fail "the controller of a plant that ends too late: $(cat "$out/stopped.log")"
late="$(sed -n 's/^hil_plant: at [0-9.]* s: \([0-9]*\)\.[0-9] ms late, the budget is 1000 ms (--late-ms): .*/\1/p' "$out/stopped.txt")"
[ "${late:-0}" -ge 1000 ] && grep -q ' s  too late: safe command$' "$out/stopped.txt" ||
  fail "a plant that was stopped does not tell: $(cat "$out/stopped.txt")"
safe_rows() { # rows with the safe command, and how many of them have torque on a wheel; NAME
  awk -F, 'NR > 1 && $15 == 1 { n++; torque += $5 != 0 || $6 != 0 || $7 != 0 } END { print n + 0, torque + 0 }' "$out/$1.csv"
}
tail -n 1 "$out/stopped.csv" | awk -F, '{ exit !($15 == 1 && $5 == 0 && $6 == 0 && $7 == 0) }' ||
  fail "a plant that ends too late is not safe: $(tail -n 1 "$out/stopped.csv")"

# A controller that stands still for 1 s: no torque on the wheels from the watchdog's time on, until it is back.
begin silent --seconds 4 --late-ms 60000
comes
kill -STOP $controller_id
sleep 1
kill -CONT $controller_id
end 0 1
wait $controller_id || fail "the controller that was stopped: $(cat "$out/silent.log")"
[ "$(figure silent trips)" -ge 1 ] && [ "$(figure silent recoveries)" -ge 1 ] || fail "a silent controller: $(cat "$out/silent.txt")"
set -- $(safe_rows silent)
[ "$1" -ge 100 ] && [ "$2" = 0 ] || fail "a silent controller: $1 rows are safe, $2 of them with torque"
ok "lock-step as called, $(digest direct); $(awk '/^  refused/ { n += $NF } END { print n }' "$out/malformed.txt") malformed packets" \
  "refused, $strangers of a stranger; $(figure crash trips) crash recovered; stopped, ended after $late ms; $(sed -n 's/^  missed/in real time missed/p' "$out/real_time.txt")"
