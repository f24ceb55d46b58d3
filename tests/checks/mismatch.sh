#!/bin/sh
# Two files with different options do not link, and the message names both configurations; with equal options they do.
# The same holds when unused sections are collected.
. tests/checks/common.sh
need gcc gcc
need clang clang
cat > "$out/user.c" << 'EOF'
#include "flexbeam.h"
int main(void)
{
  return 0; /* calls nothing: the header alone must notice */
}
EOF
refused=0
room="-DFB_WITH_BUILD=0 -DFB_WITH_SYSTEM=0 -DFB_WITH_EXACT=0" # the guard is in no room: the smallest library has it
for cc in gcc clang; do
  for sections in "" "-ffunction-sections -fdata-sections -Wl,--gc-sections"; do
    for opt in -O0 -O2; do
      try $cc -std=c99 -I. $opt $room ${sections%-Wl*} -c -o "$out/impl.o" "$out/impl.c"
      try $cc -std=c99 -I. $opt $room $sections -o "$out/program" "$out/user.c" "$out/impl.o" -lm
      for option in FB_MAX_MODES=6 FB_SINGLE=1 FB_MAX_NODES=9 FB_MAX_ELEMENTS=30 FB_WITH_GRAVITY=0 FB_WITH_LARGE_DEFLECTION=0 FB_WITH_ROTORS=0 FB_MAX_ROTORS=7 FB_MAX_POINTS=40 FB_MAX_LINES=2 FB_MAX_LINE_ROWS=90 FB_MAX_LINE_TABLE=900 FB_MAX_STRAINS=28 FB_MAX_LAMBDA=90 FB_MAX_EXACT=50; do
        if $cc -std=c99 -I. $opt $room $sections -D$option -o "$out/program" "$out/user.c" "$out/impl.o" -lm \
          2> "$out/log"; then
          fail "$cc $opt $sections: -D$option in one file alone links"
        fi
        grep -q 'undefined reference to .fb_config_is_' "$out/log" || fail "the message does not name the configuration"
        refused=$((refused + 1))
      done
    done
  done
done
ok "$refused mismatches refused at link time, equal options link (gcc, clang, with and without --gc-sections)"
