#!/bin/sh
# The tests and the QUICK START use nothing uninitialized: the memory sanitizer of clang, in double precision. In single the
# same lines run; what they read was written by the same lines.
. tests/checks/common.sh
need clang "clang libclang-rt-14-dev, or the version of clang"
sanitized 1 clang memory
ok "tests passed under the memory sanitizer: double $passed"
