#!/bin/sh
# lanes.sh - `sh bench/lanes.sh`: body-steps per second of fb_rk4_step, of the generated step and of its lanes (reduce --code --lanes
# --vary) on a free boom of 6 modes with every effect and damping, gcc; ratios of one run (lanes.c).
set -eu
out=build/lanes
mkdir -p $out
printf 'beam\nhub 500 0 0 0 80 80 80\nbase free\neffects full damping\ndamping 0.01\nlength 10\nelements 12\nmodes bend_y 3 bend_z 3\nstations x mass EI_y EI_z\n0 1.2 14004 14004\nend\n' > $out/boom.txt
make -s build/flexbeam
build/flexbeam reduce $out/boom.txt --name generated --code --lanes --vary stiffness,damping,mass,hub_mass,hub_inertia --out $out/code.h 2> $out/log
build/flexbeam reduce $out/boom.txt --name generated --out $out/rom.h 2> $out/log
sed -i '/^#define generated_crc/d' $out/rom.h # code.h has the same
echo " lanes  library M/s   single M/s    lanes M/s   single:1    lanes:1"
for options in "" "-mavx2" "-mavx512f"; do
  case $options in
  ?*) grep -q "${options#-m}" /proc/cpuinfo || continue ;;
  esac
  gcc -std=c99 -I. -I$out -ffp-contract=off -O2 $options -o $out/lanes bench/lanes.c -lm
  echo "gcc -O2 $options" && $out/lanes
done
