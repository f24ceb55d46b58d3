#!/bin/sh
# flexbeam advise: on bases of every kind what it finds by simulation meets the tolerance when it is run again (its
# exit status); its lines of a description give a model that takes the configuration it prints, its lines of C compile
# and run; what makes no sense is refused.
. tests/checks/common.sh

scenes=0
met=0
scene() {
  try build/flexbeam advise "$@" --simulate
  scenes=$((scenes + 1))
  met=$((met + $(grep -c '^ found ' "$out/log")))
}
scene
mv "$out/log" "$out/boom"
scene examples/boom.txt --base hinged --torque 0,0,0,100 --frequency 0.1 --tolerance 10,1
scene examples/satellite.txt --base pinned --gravity 0,-1,0 --duration 3 --tolerance 10,1
scene examples/satellite.txt --torque 0,0,0,8 --frequency 0.05 --duration 40
scene examples/satellite_wheels.txt --motor 2,2 --frequency 0.1 --duration 40
scene examples/blade.txt --spin 1.267 --gravity 0,-9.81,0 --force 1,0,2000,5000 --frequency 0.2 --frame 0.1 \
  --tolerance 5

# for 1 %
sed -n '/^1 %: [A-Z]/,/^$/p' "$out/boom" > "$out/advice"
word() {
  sed -n "s/^  $1 /$1 /p" "$out/advice"
}
sed -e "s/^modes .*/$(word modes)/" -e "s/^effects .*/$(word effects)/" examples/boom.txt > "$out/body.txt"
try build/flexbeam reduce "$out/body.txt" --out "$out/body.h"
grep -o -e '-DFB_[A-Z_]*=[0-9]*' "$out/advice" > "$out/flags"
sed '/^#/,$d' "$out/body.h" | grep -o -e '-DFB_[A-Z_]*=[0-9]*' | cmp - "$out/flags" ||
  fail "the flags are not those of flexbeam reduce"
sed '1,/^lines of C/d' "$out/advice" > "$out/lines.h"
case $(cat "$out/lines.h") in
*fb_rk4*) work=fb_rk4_work ;;
*fb_exponential*) work=fb_exponential_work ;;
*) work=fb_implicit_work ;;
esac
try ${CC:-cc} $c99 -O1 -DLINES="\"$out/lines.h\"" -DWORK=$work -o "$out/lines" tests/checks/advise.c -lm
try "$out/lines"

# --json: the table as fields
need python3 python3
try build/flexbeam advise examples/blade.txt --spin 1.267 --force 1,0,2000,5000 --frequency 0.2 --tolerance 10,5 --json "$out/advice.json"
mv "$out/log" "$out/table"
try python3 - "$out/advice.json" "$out/table" << 'END'
import json
import re
import sys

told = json.load(open(sys.argv[1]))
row = re.compile(r' *(\S+) % +(\S+) +(.*?) +(rk4|midpoint|sdirk|exponential) +(\S+) +(\S+) ')
rows = [found.groups() for found in map(row.match, open(sys.argv[2])) if found]
letter = {'residual_inertia': 'R', 'spin_coupling': 'C'}
have = [('%g' % (100 * one['tolerance']), ''.join(letter.get(word, word[0].upper()) for word in one['effects']), len(one['modes']), one['integrator'],
         '%.3g' % one['step'], '%.1e' % one['cost']) for one in told['advice']]
want = [(*one[:2], sum(map(int, re.findall(r'\b\d+\b', one[2]))), *one[3:]) for one in rows]
if len(want) != 2 or [(a, sorted(b), *c) for a, b, *c in have] != [(a, sorted(b), *c) for a, b, *c in want]:
    sys.exit('%s is not %s' % (have, want))
if told['units']['step'] != 's' or any(one['simulated'] or not one['error']['all'] <= one['tolerance'] for one in told['advice']):
    sys.exit(str(told))
END

# nothing that it writes takes the place of the description, or of another
cp examples/boom.txt "$out/own.csv"
ln -f "$out/own.csv" "$out/same.csv"
for files in "--json $out/same.csv" "--simulate --out $out/own" "--json $out/tried.csv --simulate --out $out/tried" "--json $out/tried.svg --out $out/tried"; do
  ! build/flexbeam advise "$out/own.csv" --spin 6 --spin-rate 1 $files > "$out/log" 2>&1 || fail "advise $files: not refused"
  grep -Eq "that is (the description itself|what --out writes)" "$out/log" || fail "advise $files: $(cat "$out/log")"
done
cmp -s examples/boom.txt "$out/own.csv" || fail "advise wrote over its description"

# large deflection: the line of modes has the points that they want, and a body takes it
try build/flexbeam advise examples/boom.txt --base prescribed --force 1,0,0,200 --frequency 0.05
sed -n '/^1 %: [A-Z]/,/^$/p' "$out/log" > "$out/advice"
grep -q '^  effects large' "$out/advice" && grep -q '^  modes bend_z [1-9] points [1-9]' "$out/advice" ||
  fail "no points of large deflection: $(cat "$out/advice")"
sed -e "s/^modes .*/$(word modes)/" -e "s/^effects .*/$(word effects)/" examples/boom.txt > "$out/body.txt"
try build/flexbeam reduce "$out/body.txt" --out "$out/body.h"

refused=0
sed -e '/^line/d' -e 's/^effects full/effects spin/' examples/panel.txt > "$out/panel.txt"
while read -r options; do
  status=0
  build/flexbeam advise $options > "$out/log" 2>&1 || status=$?
  [ $status = 2 ] && [ "$(wc -l < "$out/log")" = 1 ] || { cat "$out/log"; fail "status $status of advise $options"; }
  refused=$((refused + 1))
done << 'END'
nothing.txt
--spin 1,2
--spin-rate -1
--frequency often
--force 1,0,0
--force 2,1,0,0
--node 2
--tolerance 0
--modes 1.5,2
--duration nan
--pulse --frequency jump
--motor 1
examples/satellite_wheels.txt --motor 3,1
examples/satellite.txt --acceleration 1
build/checks/advise/panel.txt --base prescribed --acceleration 0,0,1
END
ok "$scenes scenes, $met tolerances met again; flags as of reduce; lines of C: $("$out/lines"); $refused inputs refused"
