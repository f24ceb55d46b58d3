#!/bin/sh
# Runs per second of examples/campaigns/slew.txt by number of processes, of MPI ranks, and of lanes of one process, each the median
# of three rounds that take turns; speed-up against one, of lanes against one process without. The processor time of a run tells what more processes cost (mpirun does not tell that of its ranks).
set -eu
out=build/bench_campaign
mkdir -p "$out"
cores=$(getconf _NPROCESSORS_ONLN)
runs=${1:-200}

# round KIND N JOBS COMMAND...
round() {
  label="$1 $2"
  jobs=$3
  shift 3
  (
    "$@" examples/campaigns/slew.txt $jobs --runs "$runs" --fresh --pictures 0 --out "$out/rows.csv" > "$out/report" 2> "$out/log"
    times > "$out/times"
  )
  echo "$label $(tr '\r' '\n' < "$out/log" | sed -n 's/.* failed, \(.*\) runs\/s, .* in all.*/\1/p')" \
    "$(sed -n '2s/[ms]/ /gp' "$out/times" | awk '{ print 60 * $1 + $2 + 60 * $3 + $4 }')" >> "$out/rounds"
}

: > "$out/rounds"
for k in 1 2 3; do
  n=1
  while [ $n -le "$cores" ]; do
    round processes $n "--jobs $n" build/flexbeam campaign
    [ ! -x build/examples/campaign_mpi ] || round ranks $n "" mpirun --allow-run-as-root --bind-to none -n $n build/examples/campaign_mpi
    n=$((2 * n))
  done
  for n in 1 2 4 8; do
    round with-lanes $n "--jobs 1 --lanes $n" build/flexbeam campaign
  done
done
sort -k1,1 -k2,2n -k3,3n "$out/rounds" | awk -v runs="$runs" '
  BEGIN { printf "%-10s %4s %9s %9s %26s\n", "kind", "n", "runs/s", "speed-up", "processor time of a run" }
  { key = $1 " " $2; if (key != last) { n = 0; last = key }; rate[n] = $3; time[n++] = $4 }
  n == 3 { if ($2 == 1 && $1 != "with-lanes") one = rate[1]
           if ($1 == "processes" && $2 == 1) single = rate[1]
           if ($1 == "with-lanes") one = single
           printf "%-10s %4d %9.1f %9.2f %26s\n", $1, $2, rate[1], rate[1] / one,
                  $1 == "ranks" ? "-" : sprintf("%.1f ms", 1000 * time[1] / runs) }'
