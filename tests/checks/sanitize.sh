#!/bin/sh
# The tests and the QUICK START run clean under the address and undefined-behavior sanitizers of gcc, in both precisions.
. tests/checks/common.sh
need gcc gcc
sanitized gcc address,undefined -O1 -DFB_SINGLE=0
double=$passed
sanitized gcc address,undefined -O1 -DFB_SINGLE=1
ok "tests passed under the address and undefined-behavior sanitizers: double $double, single $passed"
