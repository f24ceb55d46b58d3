#!/bin/sh
# Stack of the steps and of model building, summed along the call graph that gcc writes (12 modes, 20 elements, -O2 or -Os by day,
# double precision, each board in its own; without large deflection and rotors, and with both; building on the desktop). libc and libm
# count as nothing. Bounds: what was measured and about a quarter more.
. tests/checks/common.sh
. tests/checks/board.sh
need gcc gcc
step_bound=6720 # SDIRK, 6672: rows of Lambda(q) are held through an evaluation
build_bound=36864
large_step_bound=77824 # with FB_WITH_LARGE_DEFLECTION=1, FB_WITH_ROTORS=1: what a step knows about the lines (fbi_line_work, 54072)
large_bound=102400      # evaluations beside the step and building
# usage NAME COMPILER...: writes the call graph of one build, to a file of that name and a number
builds=0
usage() {
  builds=$((builds + 1))
  object=$1$builds.o
  shift
  (cd "$out" && "$@" -std=c99 -I../../.. -ffp-contract=off -fstack-usage -fcallgraph-info=su -c -o "$object" impl.c)
}

flies="-DFB_WITH_LARGE_DEFLECTION=0 -DFB_WITH_ROTORS=0"
for opt in $(turn -O2 -Os); do # on the desktop numbers of double precision are the larger ones
  usage large gcc $opt
  usage desktop gcc $opt $flies -DFB_WITH_BUILD=0 # building: below
  for single in 0 1; do
    precision $([ $single = 1 ] && echo single || echo double)
    usage board arm-none-eabi-gcc $processor -mthumb -mfloat-abi=hard $opt -DFB_SINGLE=$single $flies -DFB_WITH_BUILD=0
  done
done
usage desktop gcc -O2 $flies
# node: { title: "impl.c:f" label: "f\nfile:line:col\nBYTES bytes (static)" }, edge: { sourcename: "f" targetname: "g" }
awk -F '"' '
  /^node/ && $4 ~ / bytes / { t = $4; sub(/.*\\n/, "", t); split(t, part, " "); own[FILENAME, $2] = part[1]
                              if (t ~ /dynamic\)/) print "unbounded", $2, 0
                              name[FILENAME, $2] = $2 }
  /^edge/ { calls[FILENAME, $2] = calls[FILENAME, $2] "\n" $4 }
  function depth(file, f,    list, n, i, d, most) {
    if ((file, f) in total) return total[file, f]
    if (++level > 100) { print "recursion", f, 0; exit }
    n = split(calls[file, f], list, "\n")
    for (i = 2; i <= n; i++) { d = depth(file, list[i]); most = d > most ? d : most }
    level--
    return total[file, f] = own[file, f] + most
  }
  END { for (key in name) { split(key, part, SUBSEP); f = part[2]; sub(/.*:/, "", f)
                            large = part[1] ~ /large/ ? "large" : ""
                            print "total" large, f, depth(part[1], part[2]); print "own", f, own[key] } }
' "$out"/*.ci | sort -k 3,3nr > "$out/stack"
grep -E '^(unbounded|recursion)' "$out/stack" && fail "stack without a bound"
# deepest KIND PATTERN: bytes, of which function
deepest() {
  awk -v kind="$1" -v pattern="$2" '$1 == kind && $2 ~ pattern { print $3 " in " $2; exit }' "$out/stack"
}

stepper='^fb_((system_)?rk4|midpoint|(system_)?sdirk|exponential|exact)_step$'
step=$(deepest total $stepper) build=$(deepest total .)
worst=$(awk '$1 == "own" { print $3 " in " $2; exit }' "$out/stack")
large_step=$(deepest totallarge $stepper) large=$(deepest totallarge .)
step=${step:-99999}
[ "${step%% *}" -le $step_bound ] || fail "a step takes $step bytes with what it calls, bound $step_bound"
large_step=${large_step:-99999} large=${large:-99999}
[ "${large_step%% *}" -le $large_step_bound ] || fail "with large deflection a step takes $large_step bytes, bound $large_step_bound"
[ "${large%% *}" -le $large_bound ] || fail "with large deflection $large bytes, bound $large_bound"
[ "${build%% *}" -le $build_bound ] || fail "model building takes $build bytes, bound $build_bound"
ok "$builds builds, steps with all below them $step bytes, deepest $build, single function $worst; with large deflection a step $large_step, deepest $large"
