#!/bin/sh
# make bench-peers: the LU beside LAPACK's, the integrators beside SUNDIALS' with the same right-hand side, bodies beside
# MuJoCo's chains of links, on one thread, as ratios. Every LAPACK that Debian's alternatives know is measured, elsewhere the
# one that the linker finds. A quarter of an hour.
# CSV: build/bench_peers_lu.csv, _step.csv, _mujoco.csv; the tables on stdout. Exit: 0, 1 without the libraries.
set -eu
mkdir -p build
probe() {
  printf '%s\nint main(void) { return 0; }\n' "$1" | ${CC:-cc} -x c -o build/probe - $2 2> /dev/null
}
probe '#include <cvode/cvode.h>' '-lsundials_cvode -lsundials_arkode' && probe '' '-llapack -lblas' &&
  probe '#include <mujoco/mujoco.h>' -lmujoco || {
  echo "make bench-peers needs SUNDIALS 6 or later, LAPACK and MuJoCo: apt-get install libsundials-dev liblapack-dev libmujoco-dev"
  echo "(and libopenblas-dev, to be measured beside the reference LAPACK)"
  exit 1
}
${MAKE:-make} -s build/bench/bench_peers_lu_double build/bench/bench_peers_step_double build/bench/bench_peers_mujoco_double
export OPENBLAS_NUM_THREADS=1
directory=$(dirname "$(${CC:-cc} -print-file-name=liblapack.so)")
: > build/bench_peers_lu.csv
for library in "$directory/lapack" "$directory"/openblas-*; do
  [ ! -e "$library/liblapack.so.3" ] ||
    LD_LIBRARY_PATH=$library:$directory/blas build/bench/bench_peers_lu_double >> build/bench_peers_lu.csv
done
[ -s build/bench_peers_lu.csv ] || build/bench/bench_peers_lu_double > build/bench_peers_lu.csv
build/bench/bench_peers_step_double > build/bench_peers_step.csv 2> build/bench_peers_step.log || {
  cat build/bench_peers_step.log
  exit 1
}
build/bench/bench_peers_mujoco_double tests/reference/p07C_second_order.csv build/bench_peers_chain.xml \
  > build/bench_peers_mujoco.csv
awk -F, -f bench/peers.awk build/bench_peers_lu.csv build/bench_peers_step.csv build/bench_peers_mujoco.csv
