#!/bin/sh
# Jacobian and elimination of the exact beam, block by block; the rates of a body's momenta with its shape (-O2, double).
. tests/checks/common.sh
need gcc gcc
try gcc $c99 -O2 -Wno-unused-function -o "$out/jacobian" tests/checks/jacobian.c -lm
try "$out/jacobian"
exact=$(cat "$out/log")
try gcc $c99 -O2 -Wno-unused-function -o "$out/shape_rates" tests/checks/shape_rates.c -lm
try "$out/shape_rates"
ok "$exact; $(cat "$out/log")"
