#!/bin/sh
# The tests and the QUICK START run clean under the address and undefined-behavior sanitizers of gcc, in double precision. In
# single the same lines run by the same indices; check-hostile and check-faults run every function in both.
. tests/checks/common.sh
need gcc gcc
sanitized gcc address,undefined
try "$out/runner" --brief
passed=$(tail -n 1 "$out/log" | cut -d ' ' -f 1)
ok "tests passed under the address and undefined-behavior sanitizers: double $passed"
