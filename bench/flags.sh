#!/bin/sh
# make bench-flags: time of a step of rk4 (the median of bench_step, a body with every inertial effect and 6 or 12 modes) and
# code of the whole library by compiler flags, against gcc -O2. Every variant runs once in each of three rounds; the least counts.
set -eu
out=build/flags_compared
mkdir -p "$out"
base="-std=c99 -I. -ffp-contract=off"
printf '#define FLEXBEAM_IMPLEMENTATION\n#include "flexbeam.h"\n' > "$out/library.c"
cat > "$out/variants" << 'EOF'
gcc -O0
gcc -Os
gcc -O1
gcc -O2
gcc -O2 -fno-math-errno
gcc -O2 -DFB_SINGLE=1
gcc -O2 -fsanitize=address,undefined
gcc -O3
gcc -O3 -march=native
gcc -O2 -march=native -ffp-contract=fast
gcc -O3 -march=native -ffp-contract=fast -ffast-math -DFB_ALLOW_FAST_MATH
clang -O2
clang -O3 -march=native
EOF
if ! command -v clang > /dev/null; then
  echo "without clang (Debian: apt-get install clang)"
  sed -i '/^clang/d' "$out/variants"
fi

k=0
while read -r variant; do
  k=$((k + 1))
  echo "flags: building $k of $(wc -l < "$out/variants"): $variant" >&2
  compiler=${variant%% *} flags="$base ${variant#* }"
  $compiler $flags -DFBB_FLAGS='""' -DFBB_COMMIT='""' -o "$out/bench_$k" bench/bench_step.c -lm
  $compiler $flags -c -o "$out/library.o" "$out/library.c"
  size "$out/library.o" | awk 'NR == 2 { print $1 }' > "$out/code_$k"
done < "$out/variants"
for round in 1 2 3; do
  for each in $(seq $k); do
    "$out/bench_$each" | awk -F, -v each="$each" '$1 == "moving" && $3 == "full" && $2 >= 6 { print each, $2, $5 }'
  done
done > "$out/times"

awk -v out="$out" '
  FILENAME == ARGV[1] { at = $1 SUBSEP $2; if (!(at in ns) || $3 < ns[at]) ns[at] = $3; next }
  { variant[++n] = $0; if ($0 == "gcc -O2") base = n; getline code[n] < (out "/code_" n) }
  END {
    printf "%-76s %7s %8s %9s\n", "flags, beside -std=c99 -ffp-contract=off", "6 modes", "12 modes", "code [kB]"
    for (i = 1; i <= n; i++)
      printf "%-76s %7.2f %8.2f %9.0f\n", variant[i], ns[i, 6] / ns[base, 6], ns[i, 12] / ns[base, 12], code[i] / 1000
  }' "$out/times" "$out/variants"
