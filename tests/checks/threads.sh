#!/bin/sh
# Two bodies stepped by two threads at once give the bits of each alone; the thread sanitizer sees nothing shared.
. tests/checks/common.sh
need gcc gcc
for sanitizer in "" -fsanitize=thread; do
  try gcc $c99 -O2 $sanitizer -DFLEXBEAM_STATIC -pthread -o "$out/threads" tests/checks/threads.c -lm
  try "$out/threads"
done
ok "$(cat "$out/log")"
