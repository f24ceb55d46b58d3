#!/bin/sh
# Stack of the steps and of model building, summed along the call graph that gcc writes (12 modes, 20 elements, -O2 and -Os).
# libc and libm count as nothing. Bounds: what was measured and about a quarter more.
. tests/checks/common.sh
need gcc gcc
step_bound=5632
build_bound=36864
for opt in -O2 -Os; do
  for single in 0 1; do
    (cd "$out" && gcc -std=c99 -I../../.. -ffp-contract=off $opt -DFB_SINGLE=$single -fstack-usage \
      -fcallgraph-info=su -c -o "impl$opt$single.o" impl.c)
  done
done
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
                            print "total", f, depth(part[1], part[2]); print "own", f, own[key] } }
' "$out"/*.ci | sort -k 3,3nr > "$out/stack"
grep -E '^(unbounded|recursion)' "$out/stack" && fail "stack without a bound"
step=$(awk '$1 == "total" && $2 ~ /^fb_[a-z0-9]*_step$/ { print $3 " in " $2; exit }' "$out/stack")
build=$(awk '$1 == "total" { print $3 " in " $2; exit }' "$out/stack")
worst=$(awk '$1 == "own" { print $3 " in " $2; exit }' "$out/stack")
step=${step:-99999}
[ "${step%% *}" -le $step_bound ] || fail "a step takes $step bytes with what it calls, bound $step_bound"
[ "${build%% *}" -le $build_bound ] || fail "model building takes $build bytes, bound $build_bound"
ok "steps with all below them $step bytes, deepest $build, single function $worst"
