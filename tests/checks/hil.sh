#!/bin/sh
# Hardware in the loop: the bytes of the packets, also on a big-endian machine; lock-step gives the same bits as a controller
# that is called; a plant among malformed packets refuses each for its reason; a controller that crashes in the slew trips
# the watchdog, the next one recovers the pointing; a run in real time (how late it wakes is the machine's: not judged).
. tests/checks/common.sh
need gcc gcc
need qemu-mips qemu-user
need mips-linux-gnu-gcc "gcc-mips-linux-gnu libc6-dev-mips-cross"
plant=build/examples/hil_plant
controller="build/examples/hil_controller --priority 0"
running=
trap 'kill $running 2> /dev/null || true' EXIT

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

sanitize="-O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all"
try gcc $c99 $sanitize -o "$out/hil" tests/checks/hil.c -lm
try "$out/hil"
try mips-linux-gnu-gcc $c99 -O2 -static -o "$out/hil_mips" tests/checks/hil.c -lm
try qemu-mips "$out/hil_mips"

try "$plant" --simulated-time direct --seconds 30 --out "$out/direct.csv"
mv "$out/log" "$out/direct.txt"
! "$plant" --simulated-time direct --seconds 30 --out "$out/none/direct.csv" > "$out/log" 2>&1 || fail "wrote where it cannot"
grep -q "cannot write" "$out/log" && ! grep -q "pointing" "$out/log" || { cat "$out/log"; fail "--out is refused after the run"; }
begin lock_step --simulated-time lock-step --seconds 30
try $controller --port "$port"
end 0
cmp -s "$out/direct.csv" "$out/lock_step.csv" || fail "lock-step and direct: other curves"
[ "$(digest direct)" = "$(digest lock_step)" ] || fail "lock-step and direct: other digests"

# A repeated answer, where this machine made the plant ask twice, is the one refusal that the clock can add.
begin malformed --simulated-time lock-step --seconds 10 --patience 0.5
"$out/hil" "$port" > "$out/expected" || fail "the sender of malformed packets"
try $controller --port "$port"
end 0
grep '^  refused, ' "$out/malformed.txt" | grep -v 'old or repeated' > "$out/refused"
grep -v 'old or repeated' "$out/expected" | cmp -s - "$out/refused" || {
  cat "$out/expected" "$out/malformed.txt"
  fail "not every malformed packet is refused for its reason"
}
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

begin real_time --seconds 2
try $controller --port "$port"
end 0 1
grep -q '^2000 periods of 1 ms' "$out/real_time.txt" || fail "real time: $(cat "$out/real_time.txt")"
grep -q 'angular momentum.* ok$' "$out/real_time.txt" || fail "real time: $(cat "$out/real_time.txt")"
ok "lock-step as called, $(digest direct); $(awk '/^  refused/ { n += $NF } END { print n }' "$out/malformed.txt") malformed packets" \
  "refused; $(figure crash trips) crash recovered; $(sed -n 's/^  missed/in real time missed/p' "$out/real_time.txt")"
