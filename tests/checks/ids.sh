#!/bin/sh
# Every equation id is defined once, names a test that exists, and every id that is cited anywhere is defined. Every name of
# the library that README.md uses exists. THEORY.md has the derivation of every equation, and every source of the code is there.
# The comment directly above every test cites an id, or begins with "Interface: ": no physical claim (CONTRIBUTING.md).
. tests/checks/common.sh
sed -n 's/^\/\* \[\(E[0-9]*\.[0-9]*\)\].*/\1/p' flexbeam_impl.h | sort > "$out/defined"
twice=$(uniq -d "$out/defined" | tr '\n' ' ')
[ -z "$twice" ] || fail "defined more than once: $twice"
sed -n 's/^TEST(\([a-z0-9_]*\)).*/\1/p' tests/test_*.c | sort > "$out/tests"
sed -n 's/^SUITE(\([a-z_]*\),.*/\1/p' tests/test_*.c | sort > "$out/suites"
grep -o 'X([a-z_]*)' tests/test_main.c | sed 's/X(\(.*\))/\1/' | sort | comm -3 - "$out/suites" > "$out/log"
[ ! -s "$out/log" ] || {
  cat "$out/log"
  fail "suites that tests/test_main.c does not run, or that do not exist"
}
# One line "id test" per test named in the comment that defines the id.
awk '/^\/\* \[E[0-9]+\.[0-9]+\]/ { match($0, /E[0-9]+\.[0-9]+/); id = substr($0, RSTART, RLENGTH); text = "" }
     id != "" { text = text " " $0 }
     id != "" && /\*\// { n = sub(/.*Test: */, "", text); gsub(/\([^)]*\)/, "", text); sub(/[.*].*/, "", text); gsub(/,/, " ", text)
                          k = n ? split(text, test, " ") : 0
                          for (i = 1; i <= k; i++) print id, test[i]
                          if (k == 0) print id, "(none)"
                          id = "" }' flexbeam_impl.h > "$out/named"
missing=$(awk 'NR == FNR { known[$1] = 1; next } !($2 in known) { print $1 " " $2 }' "$out/tests" "$out/named")
[ -z "$missing" ] || {
  echo "$missing"
  fail "$(echo "$missing" | wc -l) tests named by equations do not exist"
}
awk 'FNR == 1 { last = -1; comment = 0 }
     /^\/\*/ { text = ""; comment = 1 }
     comment { text = text " " $0; if (/\*\//) { comment = 0; last = FNR }; next }
     /^TEST\(/ && !(last == FNR - 1 && (text ~ /E[0-9]+\.[0-9]+/ || text ~ /^ \/\* Interface: ./)) { print FILENAME ":" FNR ": " $0 }' \
  tests/test_*.c > "$out/bare"
[ ! -s "$out/bare" ] || {
  cat "$out/bare"
  fail "$(wc -l < "$out/bare") tests whose comment cites no equation and is not Interface"
}
# Every test that any `Test:` of the library names exists, also where no id is defined.
tr '\n' ' ' < flexbeam_impl.h | sed 's/Test: /\n&/g' | sed -n 's/^Test: \([^.*]*\).*/\1/p' | sed 's/([^)]*)//g' | tr -s ', ' '\n\n' |
  grep . | sort -u > "$out/told"
missing=$(comm -23 "$out/told" "$out/tests" | tr '\n' ' ')
[ -z "$missing" ] || fail "tests that Test: names do not exist: $missing"
grep -ohE '\bE[0-9]+\.[0-9]+\b' flexbeam.h flexbeam_impl.h tests/*.[ch] examples/*.c examples/*/*.c bench/*.[ch] | sort -u > "$out/cited"
unknown=$(comm -23 "$out/cited" "$out/defined" | tr '\n' ' ')
[ -z "$unknown" ] || fail "cited but not defined: $unknown"
# tests/reference/THEORY.md derives every equation under its id, and nothing else; its tests exist.
theory=tests/reference/THEORY.md errata=tests/reference/ERRATA.md
sed -n 's/^### \(E[0-9]*\.[0-9]*\) .*/\1/p' "$theory" | sort > "$out/derived"
twice=$(uniq -d "$out/derived" | tr '\n' ' ')
[ -z "$twice" ] || fail "$theory has two headings of: $twice"
missing=$(comm -23 "$out/defined" "$out/derived" | tr '\n' ' ')
[ -z "$missing" ] || fail "no heading in $theory: $missing"
missing=$(comm -13 "$out/defined" "$out/derived" | tr '\n' ' ')
[ -z "$missing" ] || fail "in $theory, but not in the code: $missing"
# One line "id: rest" per derivation: what follows *Sources:* and *Test:* to the end of the paragraph.
awk '/^### E/ { id = $2 } /^$/ { on = 0 } /^\*Sources:\*/ { on = 1; printf "\n%s:", id } on { printf " %s", $0 }
     END { print "" }' "$theory" | grep . > "$out/sources"
missing=$(sed 's/:.*//' "$out/sources" | sort | comm -13 - "$out/derived" | tr '\n' ' ')
[ -z "$missing" ] || fail "$theory names no sources of: $missing"
missing=$(grep -v '\*Test:\* `' "$out/sources" | sed 's/:.*//' | tr '\n' ' ')
[ -z "$missing" ] || fail "$theory names no test of: $missing"
tests_of() { sed 's/.*\*Test:\*//' | grep -oE '`[a-z0-9_]+`' | tr -d '`'; }
missing=$({ tests_of < "$out/sources"; grep -E '^\| (DB|H|L)' "$errata" | grep -oE '`[a-z0-9]+_[a-z0-9_]+`' | tr -d '`'; } |
          sort -u | comm -23 - "$out/tests" | tr '\n' ' ')
[ -z "$missing" ] || fail "tests that $theory or $errata name do not exist: $missing"
# Keys of sources, [DB], sections of THEORY.md and labels of ERRATA.md: cited ones exist, listed ones are used.
sed -n 's/^- \*\*\[\([A-Z]*\)\]\*\* .*/\1/p' "$theory" | sort > "$out/keys"
# Of single letters H and L alone are sources, others units.
keys() { grep -ohE '\[([A-Z][A-Z]+|H|L)\]' "$@" | tr -d '[]' | sort -u; }
{ awk '/^\/\*/, /\*\//' flexbeam_impl.h tests/*.[ch]; awk '/REFERENCES/, /\*\//' flexbeam.h; } | keys > "$out/cited_keys"
unknown=$(comm -23 "$out/cited_keys" "$out/keys" | tr '\n' ' ')
[ -z "$unknown" ] || fail "sources that $theory does not list: $unknown"
grep -v '^- \*\*\[' "$theory" | keys > "$out/theory_keys"
unknown=$(comm -23 "$out/theory_keys" "$out/keys" | tr '\n' ' ')
[ -z "$unknown" ] || fail "$theory cites sources that it does not list: $unknown"
unknown=$(sort -u "$out/cited_keys" "$out/theory_keys" | comm -13 - "$out/keys" | tr '\n' ' ')
[ -z "$unknown" ] || fail "$theory lists sources that nothing cites: $unknown"
cites="flexbeam.h flexbeam_impl.h tests/*.[ch] examples/*.c examples/*/*.[ch] examples/scenes/*.txt bench/*.[ch] $theory"
sed -n 's/^###* \([0-9]*\(\.[0-9]*\)*\) .*/\1/p' "$theory" | sort > "$out/sections"
unknown=$(grep -ohE 'THEORY\.md [0-9]+(\.[0-9]+)?((,| and) [0-9]+(\.[0-9]+)?)*' $cites | grep -oE '[0-9]+(\.[0-9]+)?' | sort -u |
          comm -23 - "$out/sections" | tr '\n' ' ')
[ -z "$unknown" ] || fail "no such section of $theory: $unknown"
sed -n 's/^| \([A-Z]*[0-9a-z]*\) |.*/\1/p' "$errata" | sort > "$out/labels"
unknown=$(grep -ohE 'ERRATA\.md (DB|H|L)[0-9a-z]+((,| and| to) (DB|H|L)[0-9a-z]+)*' $cites | grep -oE '\b(DB|H|L)([0-9]+|[a-z])\b' |
          sort -u | comm -23 - "$out/labels" | tr '\n' ' ')
[ -z "$unknown" ] || fail "no such label in $errata: $unknown"
# Every Source of an equation: a key, an id, a section, a label, a listed name, or one of the words that stand for one.
{ sed '1,/^### 15\.1/d' "$theory" | tr '\n' ' ' | grep -o '`[^`]*`' | tr -d '`'
  sed -n 's/^- \*\*\[[A-Z]*\]\*\* \([^,(]*\)[,(].*/\1/p' "$theory" | sed 's/ and /\n/' | sed 's/.*[. ]//' | grep '...'
  printf '%s\n' 'IEEE 754' 'IEEE 802.3'; } > "$out/words"
sed 's/^/[/; s/$/]/' "$out/keys" >> "$out/words"
awk '/^\/\* \[E[0-9]+\.[0-9]+\]/ { match($0, /E[0-9]+\.[0-9]+/); id = substr($0, RSTART, RLENGTH); text = "" }
     id != "" { text = text " " $0 }
     id != "" && /\*\// { n = sub(/.*Source: /, "", text); sub(/ +(Shapes|Cost|Fails|Test): .*/, "", text)
                          print id " " (n ? text : "(none)"); id = "" }' flexbeam_impl.h > "$out/code_sources"
unknown=$(grep -vE ' .*(\bE[0-9]+\.[0-9]|THEORY\.md [0-9]|ERRATA\.md [DHL])' "$out/code_sources" | grep -vF -f "$out/words" || true)
[ -z "$unknown" ] || {
  echo "$unknown"
  fail "sources of equations that $theory does not list"
}
tr '`' '\n' < README.md | grep -xE '(fb|fbi|FB|FBI)_[A-Za-z0-9_]*[A-Za-z0-9]' | sort -u > "$out/names"
grep -ohE '\b(fb|fbi|FB|FBI)_[A-Za-z0-9_]+' flexbeam.h flexbeam_impl.h | sort -u > "$out/code"
unknown=$(comm -23 "$out/names" "$out/code" | tr '\n' ' ')
[ -z "$unknown" ] || fail "README.md names what is not there: $unknown"
ok "$(wc -l < "$out/defined") equations, each defined once, tested and derived from one of $(wc -l < "$out/keys") sources; $(wc -l < "$out/tests") tests," \
  "$(grep -hc '^/\* Interface: ' tests/test_*.c | awk '{ n += $1 } END { print n }') of the interface"
