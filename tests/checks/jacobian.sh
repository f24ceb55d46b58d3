#!/bin/sh
# Jacobian and elimination of the mixed beam, block by block (-O2, double).
. tests/checks/common.sh
need gcc gcc
try gcc $c99 -O2 -Wno-unused-function -o "$out/jacobian" tests/checks/jacobian.c -lm
try "$out/jacobian"
ok "$(cat "$out/log")"
