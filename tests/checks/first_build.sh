#!/bin/sh
# What README.md says of a first build that fails: each mistake gives the message that stands there.
. tests/checks/common.sh
need gcc gcc
need g++ g++
export LC_ALL=C # plain quotes in messages
cases=0

# says MESSAGE COMMAND...: it fails with that message, and README.md explains it
says() {
  message=$1
  shift
  "$@" > "$out/log" 2>&1 && fail "this goes well: $*"
  tr '`' "'" < "$out/log" | grep -qF -- "$message" || {
    head "$out/log"
    fail "not a word of: $message"
  }
  awk '/^#/ { here = /First build fails/ } here' README.md | grep -qF -- "$message" || fail "README.md does not explain: $message"
  cases=$((cases + 1))
}

program=examples/quickstart.c
grep -v 'define FLEXBEAM_IMPLEMENTATION' $program > "$out/declared.c"
awk '/^static fb_/ { sub(/static/, "  "); held = held $0 "\n"; next } { print } /^{/ { printf "%s", held }' $program > "$out/on_stack.c"
mkdir "$out/alone"
cp flexbeam.h "$out/alone"
try gcc -std=c99 -I. -c -o "$out/library.o" "$out/impl.c"
cc="gcc -I. -o $out/program"
says "undefined reference to 'sqrt'" $cc -std=c99 $program
says "undefined reference to 'fb_" $cc -std=c99 "$out/declared.c" -lm
says "multiple definition of 'fb_" $cc -std=c99 $program "$out/library.o" -lm
says "undefined reference to 'fb_config_is_" $cc -std=c99 -DFB_MAX_MODES=6 "$out/declared.c" "$out/library.o" -lm
says "only allowed in C99" $cc -std=c89 $program -lm
says "-ffast-math voids the finite checks" $cc -std=c99 -Ofast $program -lm
says "FB_MAX_MODES is 1..60" $cc -std=c99 -DFB_MAX_MODES=100 $program -lm
says "flexbeam_impl.h: No such file" gcc -std=c99 -I"$out/alone" -o "$out/program" $program -lm
says "only available with '-std=c++20'" g++ -x c++ -std=c++11 -Wpedantic -Werror -I. -o "$out/program" $program -lm
try $cc -std=c99 -DFB_MAX_MODES=5 $program -lm
says "more than the compile-time capacity" "$out/program"
sed 's/FB_EFFECTS_FULL}/FB_EFFECTS_LARGE}/' $program > "$out/bends.c"
try $cc -std=c99 "$out/bends.c" -lm
says "effects: FB_WITH_LARGE_DEFLECTION 1 before the include" "$out/program"
sed 's/FB_EFFECTS_FULL}/FB_EFFECTS_FULL, .n_rotor = 1}/' $program > "$out/turns.c"
says "has no member named 'n_rotor'" $cc -std=c99 "$out/turns.c" -lm
try $cc -std=c99 "$out/on_stack.c" -lm
says "Segmentation fault" sh -c "ulimit -s 2048; '$out/program'; exit \$?"
ok "$cases mistakes give the messages that README.md explains"
