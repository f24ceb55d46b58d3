#!/bin/sh
# make bench-peers: the LU beside LAPACK's, the integrators beside SUNDIALS' with the same right-hand side; beams of four scenes beside
# MuJoCo and exudyn, ten rigid links beside MuJoCo, pinocchio and drake; on one thread, in one run. Every LAPACK that Debian's
# alternatives know is measured, elsewhere the one that the linker finds. Three quarters of an hour.
# CSV: build/bench_peers_lu.csv, _step.csv, _beams.csv; the tables on stdout; with gnuplot the picture build/peers/peers.svg.
# Exit: 0, 1 without the libraries.
set -eu
mkdir -p build/peers
probe() {
  printf '%s\nint main(void) { return 0; }\n' "$1" | ${CC:-cc} -x c -o build/probe - $2 2> /dev/null
}
probe '#include <cvode/cvode.h>' '-lsundials_cvode -lsundials_arkode' && probe '' '-llapack -lblas' && [ -d /usr/include/eigen3 ] || {
  echo "make bench-peers needs SUNDIALS 6 or later, LAPACK and Eigen: apt-get install libsundials-dev liblapack-dev libeigen3-dev"
  echo "(and libopenblas-dev, to be measured beside the reference LAPACK)"
  exit 1
}
packages=$(echo build/venv_peers/lib/python3*/site-packages)
[ -d "$packages/mujoco" ] && [ -d "$packages/exudyn" ] && [ -d "$packages/pydrake" ] && [ -d "$packages/cmeel.prefix/include/pinocchio" ] || {
  echo "make bench-peers needs MuJoCo, exudyn, pinocchio and drake: sh .ci/fetch peers (1 GB into build/venv_peers)"
  exit 1
}
${MAKE:-make} -s $(printf 'build/bench/bench_peers_%s_double ' lu step beams links) build/bench/peers_links
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
{
  build/bench/bench_peers_links_double build/peers && build/bench/peers_links build/peers &&
    build/bench/bench_peers_beams_double build/peers && build/venv_peers/bin/python bench/peers.py build/peers
} > build/bench_peers_beams.csv
awk -F, -f bench/peers.awk build/bench_peers_lu.csv build/bench_peers_step.csv build/bench_peers_beams.csv
if gnuplot --version > /dev/null 2>&1; then
  gnuplot -e "folder='build/peers'" bench/peers.gp
fi
