#!/bin/sh
# Layout by .clang-format, ASCII and LF, no tabs or blanks at line ends, no path of the machine it was written on.
# The headers of FMI in examples/fmu are as their authors publish them.
. tests/checks/common.sh
need clang-format clang-format
need git git
git ls-files --cached --others --exclude-standard | grep -v -e '^tests/fuzz/corpus/' -e '^examples/fmu/fmi[23]/' | while read -r f; do [ ! -f "$f" ] || echo "$f"; done > "$out/files"
try clang-format --dry-run -Werror $(grep -E '\.([ch]|cpp)$' "$out/files")
LC_ALL=C xargs grep -nP '[^\x20-\x7E\t]|[ \t]+$' < "$out/files" > "$out/log" && {
  head "$out/log"
  fail "characters beyond ASCII, carriage returns or blanks at line ends"
}
grep -E '\.(c|h|sh|md)$' "$out/files" | xargs grep -nP '\t' > "$out/log" && {
  head "$out/log"
  fail "tabs"
}
top=$(pwd | cut -d / -f 2)
xargs grep -nE "(^|[^A-Za-z0-9_.})*])/(home|root|Users|$top)/" < "$out/files" > "$out/log" && {
  head "$out/log"
  fail "paths of a machine"
}
ok "$(wc -l < "$out/files") files: layout, ASCII, LF, no tabs, no paths of a machine"
