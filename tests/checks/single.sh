#!/bin/sh
# Where single precision loses: the same boom for 10 s in both precisions, on hubs from heavy to nearly nothing (S_0 small),
# without and with stiff axial modes, its model built in double or in single precision. Largest difference from double, by
# the largest value. What runs for long is optimized; the bits do not depend on it (bits.sh).
. tests/checks/common.sh
need gcc gcc
for built in double single; do
  mkdir -p "$out/$built"
  try gcc $c99 -O0 -DFB_SINGLE=$([ $built = single ] && echo 1 || echo 0) -o "$out/$built/reduce" -Dreduce_main=main examples/tools/reduce.c examples/tools/trace/untraced.c examples/tools/library.c -lm
done

# run BUILT PRECISION FILE: the boom's motion
run() {
  try "$out/$1/reduce" "$out/boom.txt" $([ "$2" = double ] || echo --single) --out "$out/boom.h"
  try gcc $c99 $level -DFB_WITH_BUILD=0 -DFB_WITH_SYSTEM=0 -DFB_WITH_EXACT=0 -I"$out" $(grep -o -e '-DFB_[A-Z_]*=[0-9]*' "$out/boom.h") -DSTEP=$step -o "$out/program" tests/checks/single.c -lm
  "$out/program" > "$3" || fail "hub of $hub kg, $axial axial modes, $2 precision: $(tail -n 1 "$3")"
}

# row HUB_KG AXIAL STEP BOUND_DOUBLE BOUND_SINGLE: bounds for models built in either precision, a few times what was measured
row() {
  hub=$1 axial=$2 step=$3
  level=$([ $axial = 0 ] && echo -O0 || echo -O1)
  printf '%s\n' beam 'name boom' 'length 10' 'elements 8' 'root clamped' "hub $hub 0 0 0 $hub $hub $hub" "modes bend_y 3 bend_z 3 axial $axial" \
    'effects full' 'base free' 'node 10' 'stations x mass EI_y EI_z EA i_y i_z' '0 1.2 14004 14004 3e7 0.05 0.05' '10 1.2 14004 14004 3e7 0.05 0.05' end > "$out/boom.txt"
  run double double "$out/reference"
  line="  $(printf '%6s %6s' $hub $axial)"
  for built in double single; do
    bound=$4
    run $built single "$out/motion"
    error=$(paste -d ' ' "$out/reference" "$out/motion" | awk '
      NF == 6 { for (i = 1; i <= 3; i++) { x = $i < 0 ? -$i : $i; d = $i - $(i + 3); d = d < 0 ? -d : d
                  peak[i] = x > peak[i] ? x : peak[i]; most[i] = d > most[i] ? d : most[i] } rows++ }
      END { for (i = 1; i <= 3; i++) { e = most[i] / peak[i]; worst = e > worst ? e : worst }
            printf "%.1e", rows == 2000 ? worst : 9 }')
    line="$line  $error"
    awk -v e=$error -v b=$bound 'BEGIN { exit !(e > 0 && e < b) }' || fail "hub of $hub kg, $axial axial modes, built in $built: $error, bound $bound"
    shift
  done
  echo "$line"
}

echo "  hub kg  axial  built in double, in single precision"
row 100 0 0.0025 5e-5 5e-2
row 1 0 0.0025 5e-3 1e-1
row 0.1 0 0.0025 3e-2 2e-1
row 0.01 0 0.0025 5e-2 2e-1
row 100 2 0.000125 5e-5 5e-2
row 1 2 0.000125 5e-3 1e-1
ok "single precision loses as hubs get light (ill-conditioned S_0), and by building the model in it"
