#!/bin/sh
# The tests and the QUICK START run clean under the address and undefined-behavior sanitizers of gcc, in double precision. In
# single the same lines run by the same indices; check-hostile and check-faults run every function in both.
. tests/checks/common.sh
need gcc gcc
sanitized 0 gcc address,undefined
ok "tests passed under the address and undefined-behavior sanitizers: double $passed"
