# The CSV of bench_system as two tables: chains by number of bodies, configurations beside the marks of other codes.
/^#/ { next }
$1 == "chain" { key = $4 " " $2; if (!(key in seen)) { seen[key] = 1; order[++n] = key }
                time[key, $5] = $7; if ($5 == "dense") gain[key] = $11; next }
$12 != "" && $1 != "case" { mark[++m] = sprintf("%-12s %5s  %-9s %8s %8s %8s", $1, $3, $4, $7, $12, $13) }
END {
  print "chain of n bodies with 4 modes, hinged to the ground and to each other"
  printf "%-8s %6s %10s %8s %16s %22s\n", "effects", "bodies", "recursive", "dense", "dense/recursive", "recursive: 16 to 8"
  for (i = 1; i <= n; i++) {
    split(order[i], part, " ")
    ratio = part[2] == 16 ? sprintf("%22.2f", time[order[i], "recursive"] / time[part[1] " 8", "recursive"]) : ""
    printf "%-8s %6s %10s %8s %16s%s\n", part[1], part[2], time[order[i], "recursive"], time[order[i], "dense"], gain[order[i]], ratio
  }
  print ""
  print "configurations other codes were timed with, on other machines: NASA's 42, rotor: ElastoDyn; Xeon core, 2.1 GHz"
  printf "%-12s %5s  %-9s %8s %8s %8s\n", "case", "modes", "effects", "here", "there", "factor"
  for (i = 1; i <= m; i++) print mark[i]
}
