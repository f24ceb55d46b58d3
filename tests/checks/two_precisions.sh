#!/bin/sh
# FLEXBEAM_STATIC: float and double copies of the library live in one program and agree.
. tests/checks/common.sh
need gcc gcc
need clang clang
for cc in gcc clang; do
  try $cc $c99 -O2 -DFB_SINGLE=0 -c -o "$out/double.o" tests/checks/two_precisions.c
  try $cc $c99 -O2 -DFB_SINGLE=1 -c -o "$out/single.o" tests/checks/two_precisions.c
  nm -g --defined-only "$out/single.o" | grep ' fb' && fail "a private copy has public symbols"
  try $cc -o "$out/program" "$out/double.o" "$out/single.o" -lm
  try "$out/program"
done
ok "float and double in one program, $(cat "$out/log")"
