#!/bin/sh
# A million steps: momenta and energy of a chain in free flight, closure of a four-bar (-O2, double).
. tests/checks/common.sh
need gcc gcc
try gcc $c99 -O2 -o "$out/long" tests/checks/long.c build/library/double.o -lm
try "$out/long" 1000000
ok "$(tr '\n' ';' < "$out/log" | sed 's/;$//; s/;/; /')"
