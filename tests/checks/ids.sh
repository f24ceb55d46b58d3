#!/bin/sh
# Every equation id is defined once, names a test that exists, and every id that is cited anywhere is defined. Every name of
# the library that README.md uses exists.
. tests/checks/common.sh
sed -n 's/^\/\* \[\(E[0-9]*\.[0-9]*\)\].*/\1/p' flexbeam_impl.h | sort > "$out/defined"
twice=$(uniq -d "$out/defined" | tr '\n' ' ')
[ -z "$twice" ] || fail "defined more than once: $twice"
sed -n 's/^TEST(\([a-z0-9_]*\)).*/\1/p' tests/test_*.c | sort > "$out/tests"
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
grep -ohE '\bE[0-9]+\.[0-9]+\b' flexbeam.h flexbeam_impl.h tests/*.[ch] examples/*.c bench/*.[ch] | sort -u > "$out/cited"
unknown=$(comm -23 "$out/cited" "$out/defined" | tr '\n' ' ')
[ -z "$unknown" ] || fail "cited but not defined: $unknown"
tr '`' '\n' < README.md | grep -xE '(fb|fbi|FB|FBI)_[A-Za-z0-9_]*[A-Za-z0-9]' | sort -u > "$out/names"
grep -ohE '\b(fb|fbi|FB|FBI)_[A-Za-z0-9_]+' flexbeam.h flexbeam_impl.h | sort -u > "$out/code"
unknown=$(comm -23 "$out/names" "$out/code" | tr '\n' ' ')
[ -z "$unknown" ] || fail "README.md names what is not there: $unknown"
ok "$(wc -l < "$out/defined") equations, each defined once and tested; $(wc -l < "$out/tests") tests"
