# The CSV of bench_peers_lu, bench_peers_step, and of links and beams, one after the other, as tables.
function number(x) { return x == "nan" || x == "-nan" ? "-" : x < 10 ? sprintf("%.2f", x) : sprintf("%.0f", x) }
/^# flexbeam/ && !told++ { print substr($0, 3) }
/^# machine/ && !machines++ { print substr($0, 3); print "" }
/^#/ || $1 == "library" || $1 == "what" || !/,/ { next }
$3 == "factor" || $3 == "solve" {
  if (!(($1, $3) in row)) order[++rows] = $1 SUBSEP $3
  row[$1, $3] = row[$1, $3] sprintf("%6s", number($8))
  if (!($2 in sizes)) { sizes[$2] = 1; head = head sprintf("%6d", $2) }
}
$1 == "equal" {
  line[++lines] = sprintf("%-7s %6s  %-12s", $2, $6, $4)
  for (i = 14; i <= 19; i++) line[lines] = line[lines] sprintf("%10s", number($i))
}
$1 == "beam" || $1 == "links" { # the cheapest of a code that is as good as that
  scene = $1 == "links" ? "ten links" : $2
  if (!(scene in known)) { known[scene] = 1; scenes[++n_scene] = scene }
  if (!($3 in heard)) { heard[$3] = 1; codes[++n_code] = $3 }
  for (e = 1; e <= 3; e++) {
    most = $1 == "links" ? 10 ^ (-3 * e) : 10 ^ -e
    if ($6 + 0 <= most && (!((scene, $3, e) in time) || $7 + 0 < time[scene, $3, e])) {
      time[scene, $3, e] = $7 + 0
      how[scene, $3, e] = sprintf("%-34s %10s %10s", $4, $5, $6)
    }
  }
}
END {
  print "LU of n x n by LAPACK, time to that of flexbeam"
  printf "%-24s%s\n", "n", head
  for (i = 1; i <= rows; i++) { split(order[i], part, SUBSEP); printf "%-16s %-7s%s\n", part[1], part[2], row[order[i]] }
  print ""
  print "spin-up by SUNDIALS, time at equal error to that of the cheapest integrator of flexbeam"
  printf "%-15s %-12s%10s%10s%10s%10s%10s%10s\n", "", "", "CVODE", "CVODE", "CVODE", "ARKODE", "ARKODE", "ARKODE"
  printf "%-7s %6s  %-12s%10s%10s%10s%10s%10s%10s\n", "scene", "error", "flexbeam", "Adams", "BDF", "BDF 1-2", "ERK 4", "DIRK 4", "ERK fixed"
  for (i = 1; i <= lines; i++) print line[i]
  print ""
  print "the cheapest of each at an error, of the largest output (ten links: largest angle off after 1 s [rad]);"
  print "us of processor time per simulated second; times: that by flexbeam's"
  for (i = 1; i <= n_scene; i++) {
    scene = scenes[i]
    printf "%-8s %-15s %-34s %10s %10s %12s %9s\n", scene, "", "", "step [s]", "error", "time [us]", "times"
    for (e = 1; e <= 3; e++) {
      for (k = 1; k <= n_code; k++) {
        if ((scene, codes[k], e) in time) {
          printf "%-8s %-15s %s %12s %9s\n", scene == "ten links" ? 10 ^ (-3 * e) : 10 ^ -e, codes[k], how[scene, codes[k], e],
            number(time[scene, codes[k], e]), number(time[scene, codes[k], e] / time[scene, "flexbeam", e])
        }
      }
    }
  }
}
