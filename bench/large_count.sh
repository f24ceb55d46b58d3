#!/bin/sh
# large_count.sh - `sh bench/large_count.sh`: instructions that a point of a line adds to an evaluation of the rates, by the
# number of modes, and the constants FBI_LARGE_POINT, _MODE, _PAIR of flexbeam_impl.h which meet those of 2, 6 and 12 modes.
# gcc -O2, double, rk4, a free boom; half a minute. Again after every change of the kernel of lines.
set -eu
out=build/large_count
mkdir -p $out
printf '#define FLEXBEAM_IMPLEMENTATION\n#include "flexbeam.h"\n' > $out/impl.c
gcc -std=c99 -I. -ffp-contract=off -O2 -c -o $out/impl.o $out/impl.c
gcc -std=c99 -I. -O2 -o $out/count bench/step_count.c $out/impl.o -lm -Wl,-z,now

# count Y Z POINTS: instructions of a step
count() {
  rm -f $out/step*
  valgrind --tool=callgrind --callgrind-out-file=$out/step --toggle-collect=fb_rk4_step --dump-after=fb_rk4_step \
    $out/count "$1" "$2" 0 "287/$3" 3 > $out/log 2>&1
  cat $out/step.* | sed -n 's/^summary: //p' | grep -v '^0$' | sort -n | tail -n 1
}

for modes in "1 1" "3 3" "6 6"; do
  set -- $modes
  echo "$(($1 + $2)) $(count "$1" "$2" 10) $(count "$1" "$2" 20)"
done | awk '{ n[NR] = $1; f[NR] = ($3 - $2) / 40; printf "%2d modes: %6.0f a point and evaluation, %6.0f beside them\n", $1, f[NR], $2 / 4 - 10 * f[NR] }
  END { a = (f[2] - f[1]) / (n[2] - n[1]); b = (f[3] - f[2]) / (n[3] - n[2]); pair = (b - a) / (n[3] - n[1])
        mode = a - pair * (n[1] + n[2]); printf "FBI_LARGE_POINT %.0f, FBI_LARGE_MODE %.0f, FBI_LARGE_PAIR %.1f\n", f[1] - mode * n[1] - pair * n[1] ^ 2, mode, pair }'
