#!/bin/sh
# The QUICK START of flexbeam.h and the program of README.md are examples/quickstart.c, line by line; it prints what README.md
# says.
. tests/checks/common.sh
sed -n '/^#/,$p' examples/quickstart.c > "$out/example"
sed -n '/^   QUICK START/,/^   A SYSTEM of bodies/p' flexbeam.h | sed -e '1d;$d' -e 's/^     //' | sed -n '/^#/,$p' |
  sed -e :a -e '/^\n*$/{$d;N;ba' -e '}' > "$out/header"
diff "$out/header" "$out/example" > "$out/log" || {
  head -n 20 "$out/log"
  fail "QUICK START of flexbeam.h is not examples/quickstart.c"
}
[ -f README.md ] || fail "no README.md"
awk '/^```c/ { code = 1; text = ""; next }
     /^```/ { if (code && text ~ /#define FLEXBEAM_IMPLEMENTATION/) printf "%s", text; code = 0 }
     code { text = text $0 "\n" }' README.md | sed -n '/^#/,$p' > "$out/readme"
diff "$out/readme" "$out/example" > "$out/log" || {
  head -n 20 "$out/log"
  fail "the program of README.md is not examples/quickstart.c"
}
# What it prints, compiled as README.md says
sentence='.*`cc \([^`]*\)` it prints "\([^"]*\)".*'
flags=$(sed -n "s/$sentence/\1/p" README.md)
sed -n "s/$sentence/\2/p" README.md > "$out/said"
[ -n "$flags" ] || fail 'README.md does not say on one line: `cc FLAGS` it prints "LINE"'
try ${CC:-cc} $flags -o "$out/quickstart"
"$out/quickstart" > "$out/printed" || fail "examples/quickstart.c: $(cat "$out/printed")"
cmp -s "$out/printed" "$out/said" || fail "examples/quickstart.c prints \"$(cat "$out/printed")\", README.md says \"$(cat "$out/said")\""
ok "flexbeam.h, README.md and examples/quickstart.c agree ($(wc -l < "$out/example") lines, what is printed)"
