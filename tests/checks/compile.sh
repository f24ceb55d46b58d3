#!/bin/sh
# Every program compiles without a warning: gcc in C99 and single, in C17 and double precision, clang in C99 and double, in C11
# and single; the tests by gcc in C17 and single, as C++11 by clang++ in double; others build them by gcc and clang in C99 and
# double, by clang in single, by g++ (`make test`, suite.sh, memory.sh). clang has all its warnings from the syntax. gcc has more
# from the flow in optimized code, the same in either precision: that of the examples is looked at by `make ci`, which builds
# them, and by firmware.sh, that of the benchmarks and hard cases here; that of the tests and of the library by suite.sh,
# removed.sh and `make test`, and here by -O3 for a single mode, where arrays are shortest. The library is a file of its own, left
# out of all programs (FLEXBEAM_IMPL_INCLUDED) but those that use its inside.
. tests/checks/common.sh
need gcc gcc
need g++ g++
need clang clang
count=0
programs=$(ls examples/*.c examples/*/*.c bench/*.c tests/hard/*.c | grep -v -e firmware.c -e target.c -e step_cost.c -e bench_peers -e campaign_mpi -e fmu2.c -e fmu3.c -e flexbeam_scene.c -e bench/lanes.c -e tutorial_filter)
inside="bench/bench_exact.c bench/bench_system.c bench/sizes.c examples/tools/library.c tests/test_main.c tests/test_status_detail.c"
boards="examples/firmware/firmware.c examples/tutorial_firmware.c bench/target.c bench/step_cost.c"
filter=examples/tutorial_filter.c
try build/flexbeam reduce examples/satellite.txt --single --out "$out/satellite_rom.h"
rom="-I$out $(grep -o -e '-DFB_[A-Z_]*=[0-9]*' "$out/satellite_rom.h")"
body='-DBODY=satellite -DBODY_HEADER="satellite_rom.h"'

# compile COMPILER OPTIONS...: without a warning
compile() {
  library=-DFLEXBEAM_IMPL_INCLUDED
  for argument; do
    case " $inside $boards $filter $out/impl.c " in *" $argument "*) library= ;; esac
  done
  try "$@" $base $library -o "$out/object.o"
  count=$((count + 1))
}

compile gcc -std=c99 $WARNINGS_C -O3 -DFB_WITH_FORMS=1 -DFB_MAX_MODES=1 -c "$out/impl.c"
for cc in gcc clang; do # warnings that are not ours, and some users have
  compile $cc -std=c99 -Wfloat-equal -Wswitch-enum -Wredundant-decls -fsyntax-only "$out/impl.c"
done
for points in 2 6 10; do # lines shorter than those that have a kernel of their own
  today $points || continue
  compile gcc -std=c99 $WARNINGS_C -O2 -DFB_MAX_POINTS=$points -DFB_WITH_BUILD=0 -DFB_WITH_SYSTEM=0 -DFB_WITH_EXACT=0 -DFB_WITH_ANALYSE=0 -c "$out/impl.c"
done
for file in $(echo "$programs" | grep -v '^examples/'); do
  case " $inside " in *" $file "*) continue ;; esac
  compile gcc -std=c99 $WARNINGS_C -O2 -c $file
done
for cc in gcc clang; do
  for file in $boards examples/firmware/board/desktop.c; do
    compile $cc -std=c99 $WARNINGS_C -fsyntax-only $rom $body -DDESKTOP $file
  done
done
try build/flexbeam reduce examples/satellite.txt --out "$out/satellite_true.h"
try build/flexbeam reduce examples/satellite.txt --jacobian --sensors 0 --name model --out "$out/satellite_model.h"
for cc in gcc clang; do
  compile $cc -std=c99 $WARNINGS_C -fsyntax-only -I"$out" $(grep -o -e '-DFB_[A-Z_]*=[0-9]*' "$out/satellite_true.h") $filter
done
for peer in lu:dlfcn.h step:cvode/cvode.h beams:mujoco/mujoco.h links:mujoco/mujoco.h; do # where the peers are installed
  echo "#include <${peer#*:}>" | gcc -x c -fsyntax-only - 2> /dev/null || continue
  compile gcc -fsyntax-only -std=c99 $WARNINGS_C bench/bench_peers_${peer%:*}.c
done
for single in 0 1; do
  for file in "$out/impl.c" $programs; do
    for cc in $([ $single = 1 ] && echo gcc:c99 clang:c11 || echo gcc:c17 clang:c99); do
      compile ${cc%:*} -std=${cc#*:} -fsyntax-only $WARNINGS_C -DFB_SINGLE=$single $file
    done
  done
done
for file in tests/test_*.c; do
  compile gcc -std=c17 -fsyntax-only $WARNINGS_C -DFB_SINGLE=1 $file
  compile clang++ -fsyntax-only -x c++ -std=c++11 $file
done
ok "$count compilations without a warning (gcc, clang; double, single; C99, C11, C17, C++11)"
