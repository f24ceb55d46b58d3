#!/bin/sh
# Every link of a document leads to a file of the project and to a heading of it; every generated table has one place; names
# and ids of equations that a document uses exist; counts that README.md repeats are right.
. tests/checks/common.sh
. tests/checks/documents.inc
links=0
for document in $documents; do
  sed '/^```/,/^```/d' "$document" | grep -oE '\]\([^)]*\)' | sed -e 's/^](//' -e 's/)$//' | grep -v '^https*:' | sort -u > "$out/links" || true
  while read -r link; do
    links=$((links + 1))
    file=${link%%#*}
    target=$document
    [ -z "$file" ] || target=$(dirname "$document")/$file
    [ -e "$target" ] || fail "$document links to $link, which does not exist"
    case $link in
    *#*) # a heading in lower case, blanks as hyphens, without other signs
      sed '/^```/,/^```/d' "$target" | sed -n 's/^##* //p' | tr 'A-Z ' 'a-z-' | tr -cd 'a-z0-9_\n-' | grep -qxF -- "${link#*#}" ||
        fail "$document links to $link: there is no such heading"
      ;;
    esac
  done < "$out/links"
done
cat $documents | sed -nE 's/^<!-- ([a-z0-9]+) commit=[0-9a-f]{7,40} rule=[^ ]+ -->$/\1/p; s/^<!-- (\/[a-z0-9]+) -->$/\1/p' | sort > "$out/marks"
twice=$(uniq -d "$out/marks" | tr '\n' ' ')
[ -z "$twice" ] || fail "more than one place for $twice"
sed -nE 's/.*\bblock ([a-z0-9]+).*/\1/p' bench/readme.sh | grep -vx NAME | sort -u > "$out/made"
sed 'p; s/^/\//' "$out/made" | sort > "$out/wanted"
wrong=$(comm -3 "$out/marks" "$out/wanted" | tr -d '\t' | tr '\n' ' ')
[ -z "$wrong" ] || fail "marks of tables (<!-- NAME commit=COMMIT rule=RULE -->, <!-- /NAME -->) without a table that bench/readme.sh makes, or missing: $wrong"
for document in $documents; do # each can be reached from README.md
  [ "$document" = README.md ] || grep -qF "]($document" README.md || fail "README.md does not lead to $document"
done
# A figure that README.md repeats in a sentence; excerpts of tables: tests/checks/tables.sh.
scenes=$(ls examples/scenes/*.txt | wc -l)
grep -qF "text files with $scenes examples" README.md || fail "README.md counts other than $scenes scenes"
cat $documents | tr '`' '\n' | grep -xE '(fb|fbi|FB|FBI)_[A-Za-z0-9_]*[A-Za-z0-9]' | sort -u > "$out/names"
grep -ohE '\b(fb|fbi|FB|FBI)_[A-Za-z0-9_]+' flexbeam.h flexbeam_impl.h | sort -u > "$out/code"
unknown=$(comm -23 "$out/names" "$out/code" | tr '\n' ' ')
[ -z "$unknown" ] || fail "the documents name what is not in the library: $unknown"
grep -ohE '\bE[0-9]+\.[0-9]+\b' $documents | sort -u > "$out/cited"
sed -n 's/^\/\* \[\(E[0-9]*\.[0-9]*\)\].*/\1/p' flexbeam_impl.h | sort > "$out/defined"
unknown=$(comm -23 "$out/cited" "$out/defined" | tr '\n' ' ')
[ -z "$unknown" ] || fail "the documents cite equations that are not defined: $unknown"
ok "$(echo "$documents" | wc -l) documents, $links links, $(wc -l < "$out/made") generated tables, $(wc -l < "$out/names") names of the library"
