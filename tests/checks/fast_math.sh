#!/bin/sh
# Flags that void finite checks or compensated sums are refused, one by one: by #error, or where the compiler does not tell of
# them by every _init; flags that do neither are taken. gcc before 12 told of no -fassociative-math: here by -U.
. tests/checks/common.sh
need gcc gcc
need clang clang
told=0 met=0 number=0
program="-DFB_WITH_ANALYSE=0 -DFLEXBEAM_STATIC tests/checks/fast_math.c"

# told MESSAGE CC FLAG...: #error; FB_ALLOW_FAST_MATH takes it
told() {
  message=$1
  shift
  ! "$@" -std=c99 -I. -fsyntax-only $program > "$out/log" 2>&1 || fail "this goes well: $*"
  grep -qF -- "flexbeam: $message" "$out/log" || {
    head "$out/log"
    fail "$*: not a word of $message"
  }
  try "$@" -std=c99 -I. -fsyntax-only -DFB_ALLOW_FAST_MATH $program
  told=$((told + 1))
}

# gives ANSWER CC FLAG...: in double and single precision by turns, from day to day, too; every second of them on each day
single=$((day % 2))
gives() {
  answer=$1
  shift
  number=$((number + 1))
  [ -n "${CHECK_ALL:-}" ] || [ $(((number + day / 2) % 2)) = 0 ] || return 0
  met=$((met + 1))
  try "$@" -std=c99 -I. -DFB_SINGLE=$single -o "$out/program" $program -lm
  try "$out/program"
  [ "$(cat "$out/log")" = "$answer" ] || fail "$* -DFB_SINGLE=$single: $(cat "$out/log"), expected $answer"
  single=$((1 - single))
}

associative="-fassociative-math -fno-signed-zeros -fno-trapping-math"
for cc in gcc clang; do
  for flag in -ffast-math -Ofast; do
    told "-ffast-math voids the finite checks" $cc $flag
  done
  told "-ffinite-math-only voids the finite checks" $cc -ffinite-math-only
done
for flag in "$associative" -funsafe-math-optimizations; do
  if echo | gcc $flag -dM -E - | grep -q __ASSOCIATIVE_MATH__; then
    told "-fassociative-math voids the compensated sums" gcc $flag
  fi
  gives refused gcc -O1 $flag -U__ASSOCIATIVE_MATH__
  gives refused clang -O1 $flag
done
gives refused clang -O1 -fno-honor-nans
gives refused gcc -O1 -ffinite-math-only -U__FINITE_MATH_ONLY__
for cc in gcc clang; do
  gives exact $cc -O2
  gives exact $cc -O1 -fno-math-errno -fno-trapping-math -fno-signed-zeros -freciprocal-math -ffp-contract=fast
done
gives exact gcc -O1 -fassociative-math # alone it is not in force: gcc says so
ok "$told builds refused by #error, $met more by every _init or taken (double and single by turns)"
