#!/bin/sh
# The tests and the QUICK START use nothing uninitialized: the memory sanitizer of clang, in double precision. In single the
# same lines run; what they read was written by the same lines. A fourth of the tests on each day.
. tests/checks/common.sh
need clang "clang libclang-rt-14-dev, or the version of clang"
sanitized clang memory
number=0 passed=0
for test in $("$out/runner" --brief --list); do
  number=$((number + 1))
  today $number || continue
  try "$out/runner" "$test"
  passed=$((passed + 1))
done
ok "tests passed under the memory sanitizer: double $passed"
