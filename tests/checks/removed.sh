#!/bin/sh
# An effect removed by macro is gone: no warnings, nor where all but what a step of one body runs is removed, too; less code or
# smaller tables, asking for it is refused, and with all of them removed their functions are not there. Bytes, in double
# precision: text at -O0 (32 fewer at least), sizeof fb_body, in one precision by day of a fourth of the effects; the compilers'
# warnings of all. At -O1, where gcc warns of more, what a step of one body runs, and the whole library with nothing and with
# everything removed.
. tests/checks/common.sh
need gcc gcc
need clang clang
effects="SPIN_COUPLING RESIDUAL_INERTIA SPIN_STIFFENING ACCELERATION_STIFFENING DAMPING GRAVITY NONLINEAR_STRAIN LARGE_DEFLECTION ROTORS"
step_alone="-DFB_WITH_BUILD=0 -DFB_WITH_SYSTEM=0 -DFB_WITH_EXACT=0"
all=$(for e in $effects; do printf -- '-DFB_WITH_%s=0 ' $e; done)

# warned SINGLE OPTIONS...: of nothing
warned() {
  single=$1
  shift
  try clang $c99 -fsyntax-only -DFB_SINGLE=$single "$@" "$out/impl.c"
  try clang $c99 -fsyntax-only $step_alone -DFB_SINGLE=$single "$@" "$out/impl.c"
}

# measure SINGLE OPTIONS...: sets text, body, refused
measure() {
  single=$1
  shift
  [ $single = 1 ] || try gcc $c99 -O1 $([ $# = 1 ] && echo "$step_alone") "$@" -c -o "$out/optimized.o" "$out/impl.c"
  try gcc $c99 -O0 -DFB_SINGLE=$single "$@" -c -o "$out/object.o" tests/checks/removed.c
  text=$(nm -S -t d "$out/object.o" | awk '$4 ~ /^fb/ && $3 ~ /[TtRr]/ { sum += $2 } END { print sum }') # functions and tables
  try gcc -o "$out/program" "$out/object.o" -lm
  try "$out/program"
  read -r body refused < "$out/log"
}

result= useless=
for single in $(turn 0 1); do
  warned $single
  measure $single
  full_text=$text full_body=$body
  [ $single = 1 ] || result=" full $text/$body"
  [ $refused = 000000000 ] || fail "the full build refuses effects: $refused"
  k=1
  for effect in $effects; do
    warned $single -DFB_WITH_$effect=0
    k=$((k + 1))
    [ -n "${CHECK_ALL:-}" ] || [ $(((k + day / 2) % 4)) = 0 ] || continue
    measure $single -DFB_WITH_$effect=0
    [ "$(echo $refused | cut -c $((k - 1)))" = 1 ] || fail "FB_WITH_$effect=0 does not refuse the effect: $refused"
    [ $single = 1 ] || [ $text -lt $((full_text - 32)) ] || [ $body -lt $full_body ] || useless="$useless FB_WITH_$effect=0"
    [ $single = 1 ] || result="$result, $effect $((full_text - text))/$((full_body - body))"
  done
  warned $single $all
  measure $single $all
  [ $refused = 111111111 ] || fail "all removed, but not all refused: $refused"
  [ $single = 1 ] || result="$result, all $((full_text - text))/$((full_body - body))"
done
gcc -std=c99 -I. -O0 -c -o "$out/full.o" "$out/impl.c"
gcc -std=c99 -I. -O0 $all -c -o "$out/none.o" "$out/impl.c"
for function in fbi_S_gradient fbi_gravity_add fbi_central_add fbi_damping_fill fbi_strain_sub fbi_lines_pose fbi_large_gradient fbi_line_add fbi_rotor_sub fbi_rotor_fill; do
  nm "$out/full.o" | grep -q " $function\$" || fail "no function $function: this list is out of date"
  nm "$out/none.o" | grep -q " $function\$" && fail "$function is still there with all effects removed"
done
report="bytes of code/fb_body saved, double:$result"
[ -z "$useless" ] || fail "nothing saved by$useless; $report"
ok "$report"
