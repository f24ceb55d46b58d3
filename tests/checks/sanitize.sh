#!/bin/sh
# The tests and the QUICK START run clean under the address and undefined-behavior sanitizers of gcc and the memory sanitizer of
# clang (nothing uninitialized is used), in both precisions; what FB_WITH_FORMS makes a difference to in double with it, too. FBT_SHORT: long runs are brief, they show no other code.
. tests/checks/common.sh
need gcc gcc
need clang "clang libclang-rt-14-dev, or the version of clang"
result=
for single in 0 1; do
  for cc in "gcc -fsanitize=address,undefined" "clang -fsanitize=memory"; do
    build="$cc -fno-sanitize-recover=all $c99 -g -DFB_SINGLE=$single"
    try $build -O0 -o "$out/quickstart" examples/quickstart.c -lm
    try "$out/quickstart"
    try $build -O1 -DFBT_SHORT=1 -o "$out/runner" tests/test_*.c -lm
    try "$out/runner"
    [ $single = 1 ] || {
      mv "$out/log" "$out/default"
      try $build -O1 -DFBT_SHORT=1 -DFB_WITH_FORMS=1 -o "$out/runner" tests/test_*.c -lm
      try "$out/runner" --forms
      mv "$out/default" "$out/log"
    }
    result="$result, ${cc#*=} $([ $single = 1 ] && echo single || echo double) $(tail -n 1 "$out/log" | cut -d ' ' -f 1)"
  done
done
ok "tests passed under${result#,}"
