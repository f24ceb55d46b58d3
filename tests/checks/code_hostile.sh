#!/bin/sh
# The generated step (reduce --code, scene --code) bears hostile numbers and flipped bits: tests/checks/code_hostile.c says which and
# what must come of them. Bodies with polynomial terms on each base, rigid ones, exact lines, trees; with parameters and lanes; under the
# address and undefined-behavior sanitizers, in both precisions. Every fourth each day.
. tests/checks/common.sh
need gcc gcc
need g++ g++
try gcc $c99 -include examples/tools/capacities.h -DFLEXBEAM_STATIC -DWRITE -O0 -c -o "$out/write.o" tests/checks/code_tree.c # as the tracer
try g++ -o "$out/write" "$out/write.o" build/tool/trace.o build/tool/trace_single.o -lm

# attack WHAT OPTION...: code.h
number=0 texts=0 steps=0 refused=0
attack() {
  what=$1
  shift
  number=$((number + 1))
  today $number || return 0
  try gcc -fsanitize=address,undefined -fno-sanitize-recover=all $c99 -O1 "$@" -I"$out" -o "$out/run" tests/checks/code_hostile.c -lm
  "$out/run" > "$out/log" 2>&1 || {
    head -n 20 "$out/log"
    fail "$what"
  }
  texts=$((texts + 1))
  steps=$((steps + $(tail -n 1 "$out/log" | cut -d ' ' -f 1)))
  refused=$((refused + $(tail -n 1 "$out/log" | cut -d ' ' -f 2)))
}

# body SEED EFFECTS BASE OPTIONS [OPTION...]: of reduce, of the compiler
body() {
  awk -v seed="$1" -v effects="$2" -v base="$3" -v rotors="${rotors:-}" -f tests/checks/code.awk > "$out/body.txt"
  try build/flexbeam reduce "$out/body.txt" --name generated --code $4 --out "$out/code.h"
  what="seed $1, $2, $3 $4"
  shift 4
  attack "$what" "$@"
}

# tree NUMBER OPTIONS [OPTION...]: of code_tree.c, of the compiler
tree() {
  "$out/write" "$1" --members --loads > "$out/members.h"
  "$out/write" "$1" --loads $2 > "$out/code.h" || fail "tree $1 is not written"
  what="tree $1 $2"
  shift 2
  attack "$what" -DTREE "$@"
}

all=stiffness,damping,mass,hub_mass,hub_inertia
body 3 "full damping" free "" -DNUMBER=double
body 3 "full damping" free --single -DNUMBER=float
body 8 "rigid gravity" free "" -DNUMBER=double
body 5 "full damping gravity" free "--lanes --vary $all --loads 1,2" -DNUMBER=double -DVARY -Dgenerated_LANES=4
body 5 "full damping gravity" pinned "--vary $all" -DNUMBER=double -DVARY
body 5 "full damping gravity" prescribed "--single --lanes --vary $all" -DNUMBER=float -DVARY -DPRESCRIBED=1 -Dgenerated_LANES=2
rotors="0 2 1g"
body 3 "full damping" free --lanes -DNUMBER=double -Dgenerated_LANES=2
body 5 "full damping gravity" pinned --single -DNUMBER=float
body 5 "full damping gravity" prescribed "" -DNUMBER=double -DPRESCRIBED=1
rotors=
body 4 "large damping" free "--vary stiffness,damping" -DNUMBER=double -DVARY -DSAMPLE=200
body 5 "large damping" free --single -DNUMBER=float -DSAMPLE=800

# torsion moves no point: of the sum of deflections it is a part that is zero
printf 'beam\nhub 500 0 0 0 80 80 80\nbase free\neffects full\nlength 10\nelements 6\nmodes bend_y 2 bend_z 1 torsion 1\nstations x mass EI_y EI_z GJ i_y i_z\n0 1.2 14004 14004 9000 0.05 0.05\nend\n' > "$out/body.txt"
try build/flexbeam reduce "$out/body.txt" --name generated --code --single --out "$out/code.h"
attack torsion -DNUMBER=float

tree 0 "" -DNUMBER=double
tree 5 --single -DNUMBER=float
tree 6 --lanes -DNUMBER=double -Dgenerated_LANES=4
tree 7 "--single --lanes" -DNUMBER=float -Dgenerated_LANES=2
tree 12 "" -DNUMBER=double
tree 28 "" -DNUMBER=double -DLOOPS
tree 31 --single -DNUMBER=float -DLOOPS -DSAMPLE=800
tree 33 --lanes -DNUMBER=double -DLOOPS -DSAMPLE=800 -Dgenerated_LANES=4
tree 43 "" -DNUMBER=double -DSAMPLE=1500
tree 46 --single -DNUMBER=float -DSAMPLE=1500
tree 17 --lanes -DNUMBER=double -Dgenerated_LANES=4
tree 37 "" -DNUMBER=double
tree 38 --single -DNUMBER=float
tree 2 "" -DNUMBER=double
tree 7 --single -DNUMBER=float
tree 36 "--sdirk" -DNUMBER=double -DSDIRK
tree 5 "--sdirk" -DNUMBER=double -DSDIRK -Dgenerated_ITERATIONS=5 -DSAMPLE=1000
tree 6 "--sdirk --single" -DNUMBER=float -DSDIRK -Dgenerated_ITERATIONS=5 -DSAMPLE=1000
tree 17 --sdirk -DNUMBER=double -DSDIRK -Dgenerated_ITERATIONS=5
ok "$texts generated steps: of $steps steps $refused are refused and change nothing, no other gives what is not finite"
