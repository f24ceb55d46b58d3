# Coverage of flexbeam_impl.h by section from the text of gcov -b -c; lines and branches that no test takes go to the file
# `uncovered`. Fails unless more than 95 % of the lines run and more than 85 % of the branches are taken.
function row(name, l, el, b, eb) {
  printf "%-10s %6d %6.1f %% %8d %6.1f %%\n", name, l, l ? 100 * el / l : 100, b, b ? 100 * eb / b : 100
}

{
  split($0, field, ":")
}

/^ *-: *0:Source:/ {
  inside = /flexbeam_impl.h$/
}

inside && /^ *[-#=0-9*]+: *[1-9][0-9]*:/ {
  number = field[2] + 0
  text = substr($0, index($0, ":") + 1)
  text = substr(text, index(text, ":") + 1)
  if (match(text, /^   [A-Z]+ >>[a-z0-9]+/)) {
    section = substr(text, index(text, ">>") + 2)
    sub(/[: ].*/, "", section)
    order[++sections] = section
  }
  if (field[1] !~ /-$/) {
    lines[section]++
    hit = field[1] !~ /[#=]/
    taken[section] += hit
    if (!hit) {
      print section ":" number ": not run:" text > uncovered
    }
  }
}

inside && /^branch/ {
  branches[section]++
  hit = !/never executed/ && !/taken 0/
  gone[section] += hit
  if (!hit && !/never executed/) {
    print section ":" number ": a branch not taken:" text > uncovered
  }
}

END {
  printf "%-10s %6s %8s %8s %8s\n", "section", "lines", "run", "branches", "taken"
  for (i = 1; i <= sections; i++) {
    s = order[i]
    if (lines[s]) {
      row(s, lines[s], taken[s], branches[s], gone[s])
    }
    l += lines[s]
    el += taken[s]
    b += branches[s]
    eb += gone[s]
  }
  row("all", l, el, b, eb)
  exit !(el > 0.95 * l && eb > 0.85 * b)
}
