#!/bin/sh
# The object needs nothing but a few functions of libm and memory functions, has no writable data, and exports fb_ alone; of four
# builds one on each day. sincos is what gcc makes of sin and cos of one argument where the C library has it.
. tests/checks/common.sh
need gcc gcc
need clang clang
allowed='sqrtf?|sinf?|cosf?|sincosf?|atan2f?|fabsf?|expf?|memcpy|memset|memmove|memcmp|strcmp'
for build in $(turn gcc:-O2:0 clang:-O0:0 gcc:-Os:1 clang:-O2:1); do
  cc=${build%%:*} single=${build##*:} opt=${build#*:}
  object=$out/object.o
  try $cc $c99 ${opt%:*} -DFB_SINGLE=$single -fno-stack-protector -c -o "$object" "$out/impl.c"
  nm -u "$object" | sed 's/.* U //' >> "$out/undefined"
  size -A -d "$object" | awk '$1 ~ /^\.(data|bss|tdata|tbss)$/ { sum += $2 } END { exit sum != 0 }' || fail "$build: writable data"
  nm -g --defined-only "$object" | sed 's/.* //' | sort > "$out/exported"
done
grep -vE "^($allowed)\$" "$out/undefined" && fail "undefined symbols beyond the list"
grep -v '^fb_' "$out/exported" && fail "exported names that do not begin with fb_"
ok "needs only $(sort -u "$out/undefined" | tr '\n' ' ')- exports $(grep -c . "$out/exported") names, all fb_, no writable data"
