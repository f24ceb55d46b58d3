# scene.awk - of what `flexbeam scene` says about one scene: the largest difference relative to what it is compared with.
/: [^ ]+ at most from/ { note($1, $2, $16) }
/: [^ ]+ from [^ ]+, allowed/ { note($1, $2, $4) }

function note(what, difference, size, relative) {
  sub(":", "", what)
  size += 0
  size = size < 0 ? -size : size
  relative = size > 0 ? difference / size : difference
  if (relative >= worst) {
    worst = relative
    which = what
  }
}

END { printf "%-21s %8s  %-14s %s\n", name, which == "" ? "" : sprintf("%.1e", worst), which, title }
