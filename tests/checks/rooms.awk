# rooms.awk - sections of flexbeam_impl.h: which defines what, and what each uses. Prints a line for every list "(uses ...)" in
# a banner that is not what the section's code uses, and for every use of a section further down.
{
  line = $0
  if (inside) { # a comment that began above
    if (line !~ /\*\//) { banner = banner " " line; next }
    banner = banner " " line
    sub(/^.*\*\//, "", line)
    inside = 0
    begin()
  }
  if (line ~ /^\/\* -----------/) { banner = line; inside = 1; next }
  gsub(/"([^"\\]|\\.)*"/, "", line)
  gsub(/\/\*([^*]|\*[^\/])*\*\//, "", line)
  if (line ~ /\/\*/) { sub(/\/\*.*$/, "", line); inside = 1; banner = "" }
  if (line ~ /^#define/ && match(line, /FBI?_[A-Z0-9_]+/)) define(substr(line, RSTART, RLENGTH))
  if (line ~ /^(static|FB_DEF)/ && match(line, /fbi?_[A-Za-z0-9_]+(\(|\[| =)/)) {
    name = substr(line, RSTART, RLENGTH)
    sub(/(\(|\[| =)$/, "", name)
    define(name)
  }
  if (line ~ /^} fbi_[a-z0-9_]+;/) define(substr(line, 3, length(line) - 3))
  while (match(line, /[A-Za-z_][A-Za-z0-9_]*/)) {
    words[section] = words[section] " " substr(line, RSTART, RLENGTH)
    line = substr(line, RSTART + RLENGTH)
  }
}
function define(name) { if (!(name in home)) home[name] = section }
function begin(    list) {
  if (banner !~ />>/) return
  match(banner, />>[a-z0-9]+/)
  section = substr(banner, RSTART + 2, RLENGTH - 2)
  place[section] = ++count
  order[count] = section
  list = banner
  if (!sub(/^.*\(uses /, "", list)) list = ""
  sub(/\).*$/, "", list)
  said[section] = list
}
END {
  for (k = 1; k <= count; k++) {
    split("", used)
    n = split(words[order[k]], word, " ")
    for (i = 1; i <= n; i++) if (word[i] in home && home[word[i]] != order[k]) used[home[word[i]]] = word[i]
    list = ""
    for (i = 1; i <= count; i++) if (order[i] in used) {
      list = list (list == "" ? "" : ", ") order[i]
      if (i > k) print ">>" order[k] " uses " used[order[i]] " of >>" order[i] ", which stands below it"
    }
    if (list != said[order[k]]) print ">>" order[k] " says (uses " said[order[k]] "), its code uses " list
  }
  if (count < 15) print "only " count " sections found"
}
