#!/bin/sh
# What a program costs the compiler: user time of gcc -O2 (CC: another one), the best of three rounds over all rows, its
# ratio to that of the whole library, and code and constants of the object. Part of `make sizes`; in README.md by
# `sh bench/readme.sh compile`. The seconds are this machine's, the ratios hardly depend on it. Then what the first results take of
# the processor, compiling and running, each in a folder where nothing is built: FIRST=0 leaves that out.
set -eu
out=build/compile
mkdir -p "$out"
rm -f "$out"/row*
rounds=3
printf '#include "flexbeam.h"\n' > "$out/declarations.c"
printf '#define FLEXBEAM_IMPLEMENTATION\n#include "flexbeam.h"\n' > "$out/whole.c"
build/flexbeam reduce examples/satellite.txt --single --out "$out/satellite_rom.h" 2> "$out/log" || { cat "$out/log"; exit 1; }
one_body="-DFB_WITH_SYSTEM=0 -DFB_WITH_EXACT=0"
rom="-I$out $(grep -o -e '-DFB_[A-Z_]*=[0-9]*' "$out/satellite_rom.h")"

# row NAME OPTIONS... FILE: another time of this row goes to its file, beside its bytes
row() {
  number=$((number + 1))
  echo "$1" > "$out/row$number.name"
  shift
  sh -c '"$@" && times' sh ${CC:-gcc} -std=c99 -I. -O2 -c -o "$out/object.o" "$@" > "$out/times"
  awk 'NR == 2 { sub(/s$/, "", $1); split($1, part, "m"); print 60 * part[1] + part[2] }' "$out/times" >> "$out/row$number.seconds"
  size "$out/object.o" | awk 'NR == 2 { print $1 }' > "$out/row$number.bytes"
}

round=0
while [ $round -lt $rounds ]; do
  round=$((round + 1))
  number=0
  row "the whole library" "$out/whole.c"
  row "FB_WITH_BUILD=0: what flies, without model building" -DFB_WITH_BUILD=0 "$out/whole.c"
  row "FB_WITH_SYSTEM=0 and FB_WITH_EXACT=0, too: one body" $one_body -DFB_WITH_BUILD=0 "$out/whole.c"
  row "examples/quickstart.c with FLEXBEAM_STATIC" -DFLEXBEAM_STATIC examples/quickstart.c
  row "examples/tutorial_firmware.c with all four" -DFLEXBEAM_STATIC $one_body -DFB_WITH_BUILD=0 $rom examples/tutorial_firmware.c
  row "a file that includes flexbeam.h alone" "$out/declarations.c"
done
printf '%-52s %9s %13s %10s\n' "${CC:-gcc} $(${CC:-gcc} -dumpversion) -O2" seconds "of the whole" "code [kB]"
for k in $(seq $number); do
  echo "$(sort -n "$out/row$k.seconds" | head -n 1) $(cat "$out/row$k.bytes") $(cat "$out/row$k.name")"
done | awk '{ seconds = $1; bytes = $2; sub(/^[^ ]+ [^ ]+ /, ""); if (NR == 1) whole = seconds
  below = seconds < 0.01 # what the clock shows
  seconds = below ? 0.01 : seconds
  printf "%-52s %9s %11s %% %10.0f\n", $0, (below ? "< " : "") sprintf("%.2f", seconds), \
    (below ? "< " : "") sprintf("%.1f", 100 * seconds / whole), bytes / 1000 }'

[ "${FIRST:-1}" = 1 ] || exit 0
# first NAME COMMAND...: of the top of a copy of the project, where what ran before is built
copy=$out/copy
rm -rf "$copy"
mkdir -p "$copy"
{ git ls-files 2> /dev/null || find . -path ./build -prune -o -type f -print; } | tar cf - -T - | tar xf - -C "$copy"
first() {
  what=$1
  shift
  (cd "$copy" && sh -c '"$@" > out.txt 2>&1 || { cat out.txt >&2; exit 1; }; times' sh "$@") |
    awk -v what="$what" 'NR == 2 { gsub(/[ms]/, " "); printf "%-52s %9.0f\n", what, 60 * $1 + $2 + 60 * $3 + $4 }'
}
printf '\n%-52s %9s\n' "of the processor, where nothing is built" seconds
first "make run: the table of the spin-up" make run
touch "$copy/examples/papers/spinup.c"
first "make run again, its file changed" make run
first "make tool" make tool
first "build/flexbeam fmu, a scene" build/flexbeam fmu examples/scenes/satellite_control.txt --out build/scene.fmu
first "build/flexbeam fmu, a body" build/flexbeam fmu examples/satellite.txt --out build/body.fmu
first "make test" make test
first "make quick" make quick
rm -rf "$copy"
