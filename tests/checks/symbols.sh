#!/bin/sh
# The object needs nothing but a few functions of libm and memory functions, has no writable data, and exports fb_ alone.
# sincos is what gcc makes of sin and cos of one argument where the C library has it.
. tests/checks/common.sh
need gcc gcc
need clang clang
allowed='sqrtf?|sinf?|cosf?|sincosf?|atan2f?|fabsf?|expf?|memcpy|memset|memmove|memcmp|strcmp'
for cc in gcc clang; do
  for opt in $([ $cc = gcc ] && echo -O2,-DFB_SINGLE=0 -Os,-DFB_SINGLE=1 || echo -O0,-DFB_SINGLE=0 -O2,-DFB_SINGLE=1); do
    object=$out/object.o
    try $cc $c99 ${opt%,*} ${opt#*,} -fno-stack-protector -c -o "$object" "$out/impl.c"
    nm -u "$object" | sed 's/.* U //' >> "$out/undefined"
    size -A -d "$object" | awk '$1 ~ /^\.(data|bss|tdata|tbss)$/ { sum += $2 } END { exit sum != 0 }' ||
      fail "$cc $opt: writable data"
    nm -g --defined-only "$object" | sed 's/.* //' | sort > "$out/exported"
  done
done
grep -vE "^($allowed)\$" "$out/undefined" && fail "undefined symbols beyond the list"
grep -v '^fb_' "$out/exported" && fail "exported names that do not begin with fb_"
ok "needs only $(sort -u "$out/undefined" | tr '\n' ' ')- exports $(grep -c . "$out/exported") names, all fb_, no writable data"
