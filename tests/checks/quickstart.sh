#!/bin/sh
# The QUICK START of flexbeam.h and the program of README.md are examples/quickstart.c, line by line; it prints what README.md
# says. The sizes of MEMORY in flexbeam.h are those of the structs.
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

# The system is the same in both, too, and does what README.md says
sed -n '/^   A SYSTEM of bodies/,/^   A GEOMETRICALLY EXACT/p' flexbeam.h | sed -e '1,2d;$d' -e 's/^     //' -e '/^$/d' > "$out/header"
awk '/^```c/ { code = 1; next } /^```/ { code = 0 } code' README.md | sed -n '/^static const fb_system_desc/,/fb_system_motion_eval/p' > "$out/system"
diff "$out/header" "$out/system" > "$out/log" || {
  head -n 20 "$out/log"
  fail "A SYSTEM of flexbeam.h is not that of README.md"
}
{
  sed '/fb_body_build(/q' examples/quickstart.c
  echo '  {'
  cat "$out/system"
  printf '    printf("%%.4f %%d\\n", (double)motion.joint[1].value[0], (int)status);\n  }\n  return 0;\n}\n'
} > "$out/system.c"
try ${CC:-cc} -std=c99 -I. -o "$out/system_of_two" "$out/system.c" -lm
said=$(sed -n 's/.* the elbow is at \([-0-9.]*\) rad:$/\1/p' README.md)
[ "$("$out/system_of_two")" = "$said 0" ] || fail "the system prints $("$out/system_of_two"), README.md says $said"

# The table of MEMORY: a line for each work struct, its size, a note
structs=$(sed -n 's/^} \(fb_[a-z0-9_]*_work\);$/\1/p; s/^struct \(fb_[a-z0-9_]*_work\) {$/\1/p' flexbeam.h)
{
  printf '#define FLEXBEAM_STATIC\n#define FB_WITH_FORMS 1\n#include "flexbeam.h"\n#include <stdio.h>\nint main(void)\n{\n'
  printf '  printf("pointer %%d\\n", (int)sizeof(void *));\n'
  printf '  printf("%s %%lu\\n", (unsigned long)sizeof(%s));\n' $(for struct in $structs; do echo $struct $struct; done)
  printf '  return 0;\n}\n'
} > "$out/sizes.c"
try ${CC:-cc} -std=c99 -I. -o "$out/sizes" "$out/sizes.c" -lm
"$out/sizes" > "$out/sizeof"
sed -n '/^   MEMORY/,/^$/p' flexbeam.h | sed 1d > "$out/memory"
awk -v first="$(sed -n '/^   MEMORY/=' flexbeam.h)" '
  NR == FNR { order[NR] = $1; size[$1] = $2; next }
  NF { line[$1] = $0; number[$1] = first + FNR }
  END {
    for (k = 2; k in order; k++) {
      name = order[k]
      has = name in line
      note = has ? line[name] : ""
      sub(/^ *[^ ]+ +[^ ]+ */, "", note)
      right = sprintf("     %-24s %8d  %s", name, size[name], note)
      sub(/ +$/, "", right)
      if (!has)
        printf "flexbeam.h: MEMORY has no line of %s, which is:\n%s\n", name, right
      else if (line[name] != right)
        printf "flexbeam.h:%d: sizeof(%s) is %d; the line should be:\n%s\n", number[name], name, size[name], right
      delete line[name]
    }
    for (name in line) printf "flexbeam.h:%d: MEMORY has a line of %s, which is no work struct\n", number[name], name
  }' "$out/sizeof" "$out/memory" > "$out/log"
if grep -qx 'pointer 8' "$out/sizeof"; then
  sizes="sizes of $(echo "$structs" | wc -l) structs"
  [ ! -s "$out/log" ] || {
    cat "$out/log"
    fail "the table of MEMORY in flexbeam.h is not what sizeof says: the above"
  }
else
  sizes="sizes of structs not compared: pointers of other than 64 bits"
fi
ok "flexbeam.h, README.md and examples/quickstart.c agree ($(wc -l < "$out/example") lines, what is printed); $sizes"
