#!/bin/sh
# make sizes: what a step of rk4 costs on a Cortex-M4F (single precision) and Cortex-M7 (double), by modes and effects: the
# satellite of examples/satellite.txt, unloaded, compiled with -O2 and no more than its model takes. Then the
# bytes of all structs by FB_MAX_MODES. Time is the desktop's, for ratios.
set -eu
out=build/sizes
mkdir -p "$out"
flags="-std=c99 -I. -ffp-contract=off -fno-math-errno -O2"
emulator="-nographic -monitor none -serial none -semihosting-config enable=on,target=native -icount shift=8"

# row PRECISION MODES NAME EFFECTS: instructions, code, constants, state, work, stack, time
row() {
  case $1 in
  single) processor="-mcpu=cortex-m4 -mfpu=fpv4-sp-d16" machine=mps2-an386 ;;
  double) processor="-mcpu=cortex-m7 -mfpu=fpv5-d16" machine=mps2-an500 ;;
  esac
  each=$(($2 / 2))
  [ $each -gt 0 ] || each=1 # a rigid body has none of them
  sed -e "s/^effects .*/effects $4/" -e "s/^modes .*/modes bend_y $each bend_z $each/" \
    -e "$(case $4 in *damping*) ;; *) echo '/^damping/d' ;; esac)" examples/satellite.txt > "$out/model.txt"
  case $4 in *gravity*) echo 'gravity 0 0 -9.81' >> "$out/model.txt" ;; esac
  build/flexbeam reduce "$out/model.txt" $([ $1 = double ] || echo --single) --out "$out/satellite_rom.h" 2> "$out/log" ||
    { cat "$out/log"; exit 1; }
  configuration="-I$out $(grep -o -e '-DFB_[A-Z_]*=[0-9]*' "$out/satellite_rom.h") -DBODY=satellite -DBODY_HEADER=\"satellite_rom.h\""
  arm-none-eabi-gcc $flags $processor -mthumb -mfloat-abi=hard -ffunction-sections -fdata-sections -nostartfiles \
    -Wl,--gc-sections -T examples/firmware/board/mps2.ld $configuration -o "$out/image.elf" bench/step_cost.c examples/firmware/board/mps2.c -lm
  qemu-system-arm -machine $machine $emulator -kernel "$out/image.elf" > "$out/board.txt" 2>&1
  ${CC:-cc} $flags $configuration -DDESKTOP -o "$out/desktop" bench/step_cost.c examples/firmware/board/desktop.c -lm
  "$out/desktop" > "$out/desktop.txt"
  code=$(arm-none-eabi-nm -S -t d "$out/image.elf" | awk '$4 ~ /^fb/ && $3 ~ /[Tt]/ { sum += $2 } END { print sum }')
  paste "$out/board.txt" "$out/desktop.txt" | awk -v p=$1 -v m=$2 -v name="$3" -v code="$code" '
    { printf "%-9s %5d  %-14s %12d %6d %6d %6d %6d %6d %7d\n", p, m, name, $1, code, $3, $4, $5, $2, $11 }'
}

if command -v arm-none-eabi-gcc > /dev/null && command -v qemu-system-arm > /dev/null; then
  echo "A step of rk4, unloaded: instructions and stack on a Cortex-M4F (single precision) or -M7 (double), gcc -O2, newlib;"
  echo "code of flexbeam, model, state, work and stack in bytes; ns on this machine, for ratios alone."
  echo "precision modes  effects        instructions   code  model  state   work  stack      ns"
  for precision in single double; do
    row $precision 0 rigid rigid
    for modes in 2 4 6 12; do
      row $precision $modes linear linear
      row $precision $modes spin spin
      row $precision $modes full full
      row $precision $modes full+damping "full damping"
      row $precision $modes full+gravity "full gravity"
    done
  done
  echo
else
  echo "instructions, code and stack on a Cortex-M want: apt-get install gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm"
fi
echo "Bytes of the structs, all effects:"
for single in 0 1; do
  for modes in 1 2 4 6 12; do
    ${CC:-cc} -std=c99 -I. -DFB_SINGLE=$single -DFB_MAX_MODES=$modes -o "$out/sizes" bench/sizes.c -lm
    "$out/sizes"
  done
done | awk 'NR == 1 || !/^precision/'
