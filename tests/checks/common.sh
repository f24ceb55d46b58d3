# common.sh - what every check shares; a check is run from the top of the project by `make check-NAME`.
# It prints one line, `ok   NAME: figures` or `FAIL NAME: why`; a failed command shows its output before.
set -eu
name=$(basename "$0" .sh)
out=build/checks/$name
rm -rf "$out"
mkdir -p "$out"
: "${WARNINGS:?run it as: make check-$name}"
base="-I. -ffp-contract=off $WARNINGS -Werror"
c99="-std=c99 $base $WARNINGS_C"
printf '#define FLEXBEAM_IMPLEMENTATION\n#include "flexbeam.h"\n' > "$out/impl.c"

ok() {
  echo "ok   $name: $*"
}

fail() {
  echo "FAIL $name: $*"
  exit 1
}

# need PROGRAM PACKAGE
need() {
  command -v "$1" > /dev/null || fail "needs $1 (apt-get install $2)"
}

# try COMMAND...: it must succeed
try() {
  "$@" > "$out/log" 2>&1 || {
    echo "$*"
    cat "$out/log"
    fail "the command above"
  }
}

# sanitized COMPILER SANITIZERS OPTIONS...: the QUICK START as it ships and the tests with FB_WITH_FORMS, which leaves out nothing, run
# clean; sets passed. FBT_SHORT: long runs are brief, they show no other code.
sanitized() {
  build="$1 -fsanitize=$2 -fno-sanitize-recover=all $c99 -g"
  shift 2
  try $build "$@" -o "$out/quickstart" examples/quickstart.c -lm
  try "$out/quickstart"
  try $build "$@" -DFBT_SHORT=1 -DFB_WITH_FORMS=1 -o "$out/runner" tests/test_*.c -lm
  try "$out/runner"
  passed=$(tail -n 1 "$out/log" | cut -d ' ' -f 1)
}
