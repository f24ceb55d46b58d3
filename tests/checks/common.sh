# common.sh - what every check shares; a check is run from the top of the project by `make check-NAME`.
# It prints one line, `ok   NAME: figures`, `skipped NAME: why` or `FAIL NAME: why`; a failed command shows its output before.
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
  echo "ok   $name: $*${slice:-}"
}

# skip WHY: what it wants is out of reach
skip() {
  echo "skipped $name: $*"
  exit 0
}

# today NUMBER [PARTS]: is it among those of this day (of random models, of what other checks run, too), every fourth one, or one
# of PARTS? CHECK_ALL=1 (make ci-all): all are
today() {
  [ -z "${CHECK_ALL:-}" ] || return 0
  slice="; slice $((day % ${2:-4} + 1)) of ${2:-4}"
  [ $((($1 + day) % ${2:-4})) = 0 ]
}
# turn WORD...: one of them, by day; all of them where CHECK_ALL=1
turn() {
  [ -n "${CHECK_ALL:-}" ] || {
    shift $((day % $#))
    set -- "$1"
  }
  echo "$*"
}
day=${CHECK_DAY:-$(($(date +%s) / 86400))}

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

# sanitized TURN COMPILER SANITIZERS: the QUICK START as it ships and the tests run clean in double precision, on every second day
# (TURN 0 or 1) a half of them; $passed: how many. FBT_SHORT, --brief: long runs are brief or left out, they show no other code.
# The library of the tests, in test_main.c, at -O1, it runs long; the rest at -O0, which compiles in a quarter of the time and
# optimizes nothing away.
sanitized() {
  [ -n "${CHECK_ALL:-}" ] || [ $((day % 2)) = $1 ] || {
    ok "its turn is every second day"
    exit 0
  }
  build="$2 -fsanitize=$3 -fno-sanitize-recover=all $c99 -g -DFB_SINGLE=0"
  try $build -O0 -o "$out/quickstart" examples/quickstart.c -lm
  try "$out/quickstart"
  build="$build -DFBT_SHORT=1"
  try $build -O1 -c -o "$out/library.o" tests/test_main.c
  try $build -O0 -o "$out/runner" "$out/library.o" $(ls tests/test_*.c | grep -v test_main) -lm
  number=0 passed=0
  for test in $("$out/runner" --brief --list); do
    number=$((number + 1))
    [ -n "${CHECK_ALL:-}" ] || [ $(((number + day / 2) % 2)) = 0 ] || continue
    try "$out/runner" "$test"
    passed=$((passed + 1))
  done
}
