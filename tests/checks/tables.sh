#!/bin/sh
# Every generated table of the documents still holds, by the rule that its first mark states beside the commit that was measured,
# <!-- NAME commit=COMMIT rule=RULE -->; both are kept by bench/readme.sh, which makes the table again (sh bench/readme.sh NAME):
#   library:N      flexbeam.h and flexbeam_impl.h have changed by at most N lines since, added and removed ones; figures of time and
#                  size, counts; library+PATH:N, so have these and PATH
#   same           made again it is the same; figures that do not depend on the machine
#   of:TABLE       an excerpt: made again from that table it is the same, and its commit is that table's
# Without the history of git lines are not counted.
. tests/checks/common.sh
. tests/checks/documents.inc
cat $documents | sed -nE 's/^<!-- ([a-z0-9]+) commit=([^ ]+) rule=([^ ]+) -->$/\1 \2 \3/p' > "$out/tables"
history=no
[ "$(git rev-parse --is-shallow-repository 2> "$out/log")" != false ] || history=yes

# lines_since COMMIT PATH...: changed lines; fails if git does not know the commit
lines_since() { git diff --numstat "$@" > "$out/numstat" 2> "$out/log" && awk '{ n += $1 + $2 } END { print n + 0 }' "$out/numstat"; }

# again TABLE: is it what it was when made again?
again() { TABLES=$out/again sh bench/readme.sh "$1" > "$out/log" 2>&1 < /dev/null && table_of "$1" | cmp -s - "$out/again/$1"; }

while read -r table commit rule; do
  case $rule in
  library*:*)
    [ $history = yes ] || continue
    paths=$(echo "${rule%:*}" | sed 's/^library/flexbeam.h flexbeam_impl.h/; s/+/ /g')
    lines=$(lines_since "$commit" -- $paths) || lines="not known how many"
    [ "$lines" -le "${rule#*:}" ] 2> "$out/log" || echo "$table: $lines lines of $paths changed since $commit, ${rule#*:} may have"
    ;;
  of:*)
    again "$table" || echo "$table: not what ${rule#of:} has"
    [ "$commit" = "$(commit_of "${rule#of:}")" ] || echo "$table: of another commit than ${rule#of:}"
    ;;
  same) again "$table" || echo "$table: no longer what it was at $commit" ;;
  *) echo "$table: no rule is called $rule" ;;
  esac
done < "$out/tables" > "$out/stale"
[ ! -s "$out/stale" ] || {
  cat "$out/stale"
  fail "$(wc -l < "$out/stale") of $(wc -l < "$out/tables") tables want sh bench/readme.sh NAME..."
}
[ $history = yes ] && counted="" || counted="; lines were not counted: no history of git"
ok "$(wc -l < "$out/tables") generated tables hold by their rules$counted"
