# board.sh - what the checks on emulated boards share: Cortex-M4F in single, Cortex-M7 in double precision.
need arm-none-eabi-gcc "gcc-arm-none-eabi libnewlib-arm-none-eabi"
need qemu-system-arm qemu-system-arm
emulator="-nographic -monitor none -serial none -semihosting-config enable=on,target=native -icount shift=8"
library_small="-DFB_MAX_EXACT=2 -DFB_MAX_BODIES=2 -DFB_MAX_SPEEDS=32 -DFB_MAX_ROWS=12 -DFB_MAX_ELEMENTS=2 -DFB_MAX_STATIONS=2 -DFB_MAX_LUMPS=1"
mkdir -p "$out/single" "$out/double"

# precision single|double: sets processor, machine, directory of the model
precision() {
  model=$out/$1
  case $1 in
  single) processor="-mcpu=cortex-m4 -mfpu=fpv4-sp-d16" machine=mps2-an386 ;;
  double) processor="-mcpu=cortex-m7 -mfpu=fpv5-d16" machine=mps2-an500 ;;
  esac
}

# rom single|double [large]: the satellite's header and the configuration it takes; large: with lines of large deflection
rom() {
  precision "$1"
  sed "s/effects full damping/effects ${2:-full} damping/" examples/satellite.txt > "$out/satellite.txt"
  try build/flexbeam reduce "$out/satellite.txt" $([ "$1" = double ] || echo --single) --out "$model/satellite_rom.h"
  configuration="-I$model $(grep -o -e '-DFB_[A-Z_]*=[0-9]*' "$model/satellite_rom.h")"
}

# image FILE SOURCE OPTIONS...: for that precision; no warning passes. -fno-math-errno: a square root is an instruction
image() {
  image=$1
  source=$2
  shift 2
  try arm-none-eabi-gcc -std=c99 $base $WARNINGS_C $processor -mthumb -mfloat-abi=hard -fno-math-errno -ffunction-sections \
    -fdata-sections -nostartfiles -Wl,--gc-sections -T examples/firmware/board/mps2.ld $configuration "$@" \
    -o "$image" "$source" examples/firmware/board/mps2.c -lm
}

# emulate IMAGE OUTPUT: its exit status
emulate() {
  qemu-system-arm -machine $machine $emulator -kernel "$1" > "$2" 2>&1
}

# bytes IMAGE SECTIONS: of them together
bytes() {
  arm-none-eabi-size -A -d "$1" | awk -v sections=" $2 " 'index(sections, " " $1 " ") { sum += $2 } END { print sum + 0 }'
}
