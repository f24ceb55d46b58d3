#!/bin/sh
# Models in ROM: the headers give back every number (they are included, written again and compared; in one precision by day); the
# firmware runs its own check, and C++20 takes them too; what is linked into it has no model building; the sizes keep their bounds.
. tests/checks/common.sh
need gcc gcc
need g++ g++
need clang clang
sed 's/effects full damping/effects large damping/' examples/satellite.txt > "$out/large.txt"
grep -q 'effects large' "$out/large.txt" || fail "examples/satellite.txt has no effects full damping"
# again NAME SOURCE SINGLE: the header is included, written again, and compared
again() {
  flags=$(grep -o -e '-DFB_[A-Z_]*=[0-9]*' "$out/rom.h")
  try gcc $c99 -O0 -I"$out" $flags -DSOURCE="\"$2\"" -o "$out/again" tests/checks/rom.c -lm
  "$out/again" > "$out/again.h"
  try clang $c99 -I"$out" $flags -DSOURCE='""' -fsyntax-only tests/checks/rom.c
  try g++ -x c++ -std=c++20 $base -Wno-missing-field-initializers -I"$out" $flags -DSOURCE='""' -fsyntax-only tests/checks/rom.c
  cmp -s "$out/rom.h" "$out/again.h" || fail "$1, $([ $3 = 1 ] && echo single || echo double): not every number comes back"
}
try gcc $c99 -O0 -o "$out/rotors" tests/checks/rom_rotors.c -lm
for taken in fb_body fbi_dot FB_OK; do # names of the library
  ! build/flexbeam reduce examples/satellite.txt --name $taken --out "$out/taken.h" 2> "$out/log" || fail "--name $taken is taken"
  grep -q "those of the library.*$taken" "$out/log" || fail "--name $taken: $(cat "$out/log")"
  [ ! -e "$out/taken.h" ] || fail "--name $taken: a file is written"
done
cp examples/satellite.txt "$out/kept.txt"
! build/flexbeam reduce "$out/kept.txt" --out "$out/../rom/kept.txt" 2> "$out/log" || fail "a description is written over"
grep -q "that is the description itself" "$out/log" && cmp -s examples/satellite.txt "$out/kept.txt" || fail "--out FILE: $(cat "$out/log")"
for single in $(turn 0 1); do
  precision=$([ $single = 1 ] && echo --single || true)
  for model in examples/blade examples/panel examples/satellite examples/two_booms examples/satellite_wheels "$out/large"; do
    try build/flexbeam reduce $model.txt $precision --name rom_body --out "$out/rom.h"
    again $model $model.txt $single
  done
  "$out/rotors" $precision > "$out/rom.h"
  grep -q 'n_rotor = 2' "$out/rom.h" || fail "rotors are not written"
  again rotors rotors $single
done
for capacity in FB_MAX_POINTS=8 FB_MAX_LINE_ROWS=5 FB_MAX_LINE_TABLE=935; do # 18, 6 and 936 are wanted
  try clang $c99 -O0 -fsanitize=address,undefined -DFB_WITH_SYSTEM=0 -DFB_WITH_EXACT=0 -DFB_WITH_ANALYSE=0 -D$capacity -o "$out/small" -Dreduce_main=main examples/tools/reduce.c examples/tools/trace/untraced.c examples/tools/library.c -lm
  ! "$out/small" "$out/large.txt" --out "$out/small.h" 2> "$out/log" || fail "$capacity takes the satellite with lines"
  grep -q "the body: more than the compile-time capacity" "$out/log" || fail "$capacity: $(cat "$out/log")"
done
for capacity in FB_MAX_LAMBDA=20 FB_MAX_S=40; do # 48 and more than 80 are wanted
  try clang $c99 -O0 -fsanitize=address,undefined -DFB_WITH_SYSTEM=0 -DFB_WITH_EXACT=0 -DFB_WITH_ANALYSE=0 -D$capacity -o "$out/small" -Dreduce_main=main examples/tools/reduce.c examples/tools/trace/untraced.c examples/tools/library.c -lm
  ! "$out/small" examples/satellite.txt --out "$out/small.h" 2> "$out/log" || fail "$capacity takes the satellite"
  grep -q "the body: more than the compile-time capacity" "$out/log" || fail "$capacity: $(cat "$out/log")"
done
try build/flexbeam reduce examples/satellite.txt --single --out "$out/satellite_rom.h"
flags=$(grep -o -e '-DFB_[A-Z_]*=[0-9]*' "$out/satellite_rom.h")
try gcc $c99 -Os -I"$out" $flags -ffunction-sections -fdata-sections -Wl,--gc-sections -o "$out/firmware" examples/firmware/firmware.c \
  examples/firmware/board/desktop.c -lm
try "$out/firmware"
nm "$out/firmware" | sed -n 's/.* [TtRr] \(fbi*_[a-z0-9_]*\)$/\1/p' | grep -v "^fb_config_is" | sort > "$out/linked"
grep -E 'beam|modes|shape|matri|body_init|_eig|chol_factor|element|section' "$out/linked" && fail "model building is linked into the firmware"
body=$(sed -n 's/^model \[bytes of ROM\] //p' "$out/log")
state=$(sed -n 's/^state \[bytes\] //p' "$out/log")
[ "$body" -lt 8192 ] || fail "the model takes $body bytes"
[ "$state" -lt 300 ] || fail "the state takes $state bytes"
code=$(nm -S -t d "$out/firmware" | awk '$4 ~ /^fb/ && $3 ~ /[Tt]/ { sum += $2 } END { print sum }')
ok "exact; firmware: $(wc -l < "$out/linked") functions of flexbeam, none that builds models, $code bytes; model $body, state $state bytes"
