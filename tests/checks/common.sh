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
