#!/bin/sh
# fuzz.sh - `make fuzz`: each harness of tests/fuzz for FUZZ_SECONDS (60) from its corpus on, in double and in single
# precision half of the time each (FUZZ_DAY, a number: one of them by turns); executions, coverage (edges), findings. A finding stays
# in build/fuzz/HARNESS, as its message says; minimized it belongs into tests/fuzz/corpus/HARNESS, with a mended library.
set -eu
: "${WARNINGS:?run it as: make fuzz}"
case ${FUZZ_SECONDS:=60} in
  *[!0-9]* | 0* | 1)
    echo "make fuzz: FUZZ_SECONDS is a whole number from 2 on; it is '$FUZZ_SECONDS'"
    exit 2
    ;;
esac
seconds=$((FUZZ_SECONDS / 2)) # 0 would be without end
level=$([ $seconds -lt 30 ] && echo -O0 || echo -O1) # a short look would be spent on compiling
command -v clang > /dev/null || {
  echo "make fuzz wants clang with libFuzzer (Debian: apt-get install clang libclang-rt-14-dev, or the version of clang)"
  exit 1
}
mkdir -p build/fuzz
findings=0
number=${FUZZ_DAY:-}
printf '%-8s %-9s %10s %8s %9s\n' harness build executions edges findings
for harness in api step import scene; do
  builds="double single"
  if [ -n "$number" ]; then # that of the day
    set -- $builds
    shift $((number % $#))
    builds=$1 number=$((number + 1))
  fi
  for build in $builds; do
    to=build/fuzz/$harness-$build
    mkdir -p "$to/corpus"
    clang -std=c99 -I. -ffp-contract=off $level -g -DFB_SINGLE=$([ $build = single ] && echo 1 || echo 0) -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all \
      -o "$to/run" tests/fuzz/$harness.c -lm > "$to/log" 2>&1 || {
      cat "$to/log"
      echo "no harness: libFuzzer is missing? (Debian: apt-get install libclang-rt-14-dev, or the version of clang)"
      exit 1
    }
    "$to/run" -close_fd_mask=1 -max_total_time=$seconds -timeout=60 -max_len=4096 -print_final_stats=1 -artifact_prefix="$to/" \
      "$to/corpus" tests/fuzz/corpus/$harness > "$to/log" 2>&1 || {
      findings=$((findings + 1))
      grep -a -e BROKEN -e ERROR -e 'runtime error' -e '^    #[0-9] ' -e 'Test unit written' "$to/log" | head -n 12
      sed -n "s|.*Test unit written to |again: $to/run |p" "$to/log"
    }
    printf '%-8s %-9s %10s %8s %9s\n' $harness ${to##*-} "$(sed -n 's/^stat::number_of_executed_units: //p' "$to/log")" \
      "$(grep -a -o 'cov: [0-9]*' "$to/log" | tail -n 1 | cut -c 6-)" "$(grep -a -c -E 'Test unit written to .*/(crash|timeout|oom|leak)-' "$to/log")"
  done
done
exit $((findings > 0))
