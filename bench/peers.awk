# The CSV of bench_peers_lu, bench_peers_step and bench_peers_mujoco, one after the other, as three tables.
function number(x) { return x == "nan" || x == "-nan" ? "-" : x < 10 ? sprintf("%.2f", x) : sprintf("%.0f", x) }
/^# flexbeam/ && !told++ { print substr($0, 3) }
/^# machine/ && !machines++ { print substr($0, 3); print "" }
/^#/ || $1 == "library" || $1 == "what" { next }
$3 == "factor" || $3 == "solve" {
  if (!(($1, $3) in row)) order[++rows] = $1 SUBSEP $3
  row[$1, $3] = row[$1, $3] sprintf("%6s", number($8))
  if (!($2 in sizes)) { sizes[$2] = 1; head = head sprintf("%6d", $2) }
}
$1 == "equal" {
  line[++lines] = sprintf("%-7s %6s  %-12s", $2, $6, $4)
  for (i = 14; i <= 19; i++) line[lines] = line[lines] sprintf("%10s", number($i))
}
$1 ~ /^equal / {
  split($1, at, " ")
  mark[++marks] = $3 == "none" ? sprintf("%-8s %-9s none", at[2], $2) : \
    sprintf("%-8s %-9s %-26s %10s %10s %12s %10s", at[2], $2, $3, $4, $5, number($6), number($7))
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
  print "spin-up by MuJoCo, against the geometrically exact beam: the cheapest of each at an error; us per simulated second"
  printf "%-8s %-9s %-26s %10s %10s %12s %10s\n", "error", "", "", "step [s]", "error", "time [us]", "times"
  for (i = 1; i <= marks; i++) print mark[i]
}
