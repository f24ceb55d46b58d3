# The CSV of bench_exact as a table.
/^#/ { next }
{ printf "%-13s %9s  %-9s %9s %9s %9s %9s %13s %12s\n", $1, $2, $3, $4, $5, $6, $7, $8, $9 }
