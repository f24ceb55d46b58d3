#!/bin/sh
# The words that write a step, scene --code and reduce --code: NAME_start is where the scene starts, inputs are what its lines drive, so
# that steps end where the scene does, by both integrators; every part of a scene is written and compiles without warnings; what
# cannot be written is refused by name, and no file is left.
. tests/checks/common.sh
need gcc gcc
need clang clang
need g++ g++

# lines TEXT...: each with ; between its lines
lines() {
  printf '%s\n' "$@" | tr ';' '\n'
}

# written FILE OPTION...: the step of that scene compiles
written() {
  file=$1
  shift
  try build/flexbeam scene "$file" "$@" --code "$out/generated.h"
  printf '#define generated_IMPLEMENTATION\n#include "generated.h"\nint main(void) { generated_state s; generated_start(&s); return 0; }\n' > "$out/main.c"
  try gcc $c99 -O2 -I"$out" -fsyntax-only "$out/main.c"
  try clang $c99 -O2 -I"$out" -fsyntax-only "$out/main.c"
  try g++ -x c++ -std=c++11 $base -O2 -I"$out" -fsyntax-only "$out/main.c"
  number=$((number + 1))
}
number=0

# driven FILE WHAT ACTS TELLS [STEPS DT]: steps of its code under `in`, which ACTS of C sets at the time t, end where the scene does; TELLS:
# three numbers of the state s, the motion m and the energy e
driven() {
  written "$1"
  try build/flexbeam scene "$1" --out "$out/way.csv"
  cat > "$out/way.c" << END
#include <math.h>
#include <stdio.h>
#define generated_IMPLEMENTATION
#include "generated.h"
static generated_input at(double t)
{
  generated_input in = {0};
  (void)t;
  $3
  return in;
}
int main(void)
{
  const double dt = ${6:-1e-3};
  generated_state s;
  generated_motion m;
  generated_energy e;
  generated_input a = at(0), b, c;
  generated_start(&s);
  for (int k = 0; k < ${5:-100}; k++, a = c) {
    b = at((k + 0.5) * dt);
    c = at((k + 1) * dt);
    (void)b;
    if (generated_step(&s, &a, $(grep -q 'their step of sdirk' "$out/generated.h" || echo '&b,') &c, dt)) {
      return 1;
    }
  }
  generated_motion_eval(&m, &s, &a);
  generated_energy_eval(&e, &s, &a);
  printf("%.17g %.17g %.17g\n", $4);
  return 0;
}
END
  try gcc $c99 -O1 -I"$out" -o "$out/way" "$out/way.c" -lm
  "$out/way" > "$out/end.txt" || fail "$2: a step is refused"
  awk -F, -v own="$(cat "$out/end.txt")" 'END { split(own, x, " ")
    for (i = 1; i <= 3; i++) { d = (x[i] - $(i + 1)) / (1 + ($(i + 1) > 0 ? $(i + 1) : -$(i + 1))); if (!(d < 1e-10 && d > -1e-10) || $(i + 1) == 0) { exit 1 } } }' \
    "$out/way.csv" || fail "$2: $(cat "$out/end.txt"), the scene $(tail -n 1 "$out/way.csv")"
  ways=$((ways + 1))
}
ways=0
run='duration 0.1;step 0.001;interval 0.001;integrator'
versine='0.5 * (t - sin(31.4159265358979324 * t) / 31.4159265358979324)' its_rate='0.5 * (1 - cos(31.4159265358979324 * t))'

# from where a scene starts, also of lines
for effects in "full damping" "large damping"; do
  lines "duration 0.1;step 0.0001;integrator rk4;body hub rigid;start_attitude 0 0 1 30;start_spin 0.1 0.05 0.02;start_velocity 1 2 3;hub 800 0 0 0 400 300 500;node 0.8 0 0 side;end" \
    "body array beam;start_mode 1 0.02 0.1;length 4;stations x mass EI_y EI_z GJ i_z;0 3 400 3000 200 0.25;end;hub 2 0 0 0 0.1 0.1 0.1;modes bend_y 3;damping 0.005;effects $effects;node tip tip;end" \
    "joint hinge revolute hub.side array;stiffness 3;damping 0.05;start 1 0.3 0.2;end;rotor fly hub;axis 0.3 0 1;inertia 4;speed 30;end" \
    "output angle coordinate hinge 1;output speed speed hinge 1;output energy energy kinetic" > "$out/start.txt"
  driven "$out/start.txt" "a start, $effects" "" 's.body_1.x[0], m.body_1.speed[0], e.kinetic' 1000 1e-4
done
# motors, axes that move at once, a driven rotor
lines "$run rk4;body crank rigid;hub 2 0.3 0 0 0.1 0.1 0.1;end;body door rigid;hub 1 0.2 0 0 0.05 0.05 0.05;end;joint drive revolute ground crank;mode prescribed;rate 1 constant 2;end" \
  "joint hinge revolute crank door;position 0.5 0 0;start 1 0.4;motor 1 constant 0.3;end;rotor fly door;axis 0 0 1;inertia 0.1;speed 5;motor constant 0.02;end" \
  "output angle coordinate hinge 1;output speed speed hinge 1;output energy energy kinetic" > "$out/crank.txt"
driven "$out/crank.txt" "a crank" 'in.body_0.value[0] = 2 * t; in.body_0.rate[0] = 2; in.body_1.motor[0] = 0.3; in.body_1.rotor_motor[0] = 0.02;' 's.body_1.x[0], m.body_1.speed[0], e.kinetic'
try build/flexbeam scene "$out/crank.txt" --code "$out/generated.h"
grep -q 'motor, value and rate of joints (from line 13) are inputs' "$out/log" && grep -q 'motor and momentum of rotors (from line 20) are inputs' "$out/log" || fail "what the caller gives: $(cat "$out/log")"
# muscles; a tether to the ground that is reeled in; one of several axes that moves at once
for scheme in rk4 sdirk; do
  lines "$run $scheme;body upper rigid;hub 2 0.3 0 0 0.1 0.1 0.1;node 0.2 0 0 mid;end;body lower rigid;hub 1 0.2 0 0 0.05 0.05 0.05;node 0.1 0 0 mid;end" \
    "joint shoulder revolute ground upper;start 1 0.4;end;joint elbow revolute upper lower;position 0.5 0 0;start 1 0.4;end;spring biceps upper.mid lower.mid;stiffness 20;length 0.3;damping 1;pull constant 3;end" \
    "spring back ground upper.mid;position 0 0.4 0 0 0 0;pull constant 2;end;spring wire ground lower.mid;stiffness 1;end;output shoulder coordinate shoulder 1;output elbow coordinate elbow 1;output energy energy strain" > "$out/muscles.txt"
  driven "$out/muscles.txt" "muscles by $scheme" 'in.pull_0 = 3; in.pull_1 = 2;' 's.body_0.x[0], s.body_1.x[0], e.strain'
  lines "$run $scheme;body satellite rigid;hub 2 0.1 0 0 0.1 0.2 0.3;node 0.3 0.1 0 hook;start_position 0 0 1;start_spin 0.2 0.1 0.5;start_velocity 1 2 -0.5;end;joint base free ground satellite;end" \
    "spring tether ground satellite.hook;stiffness 200;length 1;damping 5;pull constant 4;end;output x position satellite x;output y position satellite y;output energy energy strain" > "$out/tether.txt"
  driven "$out/tether.txt" "a tether by $scheme" 'in.pull_0 = 4;' 's.body_0.x[0], s.body_0.x[1], e.strain'
  lines "$run $scheme;body hub rigid;hub 20 0 0 0 9 11 14;end;body arm rigid;hub 2 0.5 0.1 0 0.1 0.4 0.4;end;joint base free ground hub;end" \
    "joint knee universal hub arm;position 0.3 0 0.2;mode free prescribed;rate 2 constant 0.5;start 1 0.4;motor 1 constant 0.3;end;output angle coordinate knee 1;output speed speed knee 1;output energy energy kinetic" > "$out/knee.txt"
  driven "$out/knee.txt" "a prescribed axis of several by $scheme" 'in.body_1.value[1] = 0.5 * t; in.body_1.rate[1] = 0.5; in.body_1.motor[0] = 0.3;' 's.body_1.x[0], m.body_1.speed[0], e.kinetic'
done
# the joint of a loop turns it, from rest
lines "$run rk4;body crank rigid;hub 2 0.3 0 0 0.1 0.1 0.1;end;body rod rigid;hub 1 0.5 0 0 0.05 0.1 0.1;end;body rocker rigid;hub 1 0.2 0 0 0.05 0.05 0.05;end;joint foot revolute ground crank;stiffness 1;end" \
  "joint knee revolute crank rod;position 0.3 0.4 0;end;joint far revolute ground rocker;position 1.3 -0.1 0;end;loop pin revolute rod rocker;position 1 0 0;child_position 0 0.5 0;mode prescribed;rate 1 versine 0.5 0 0.2;end" \
  "output angle coordinate foot 1;output speed speed knee 1;output energy energy kinetic" > "$out/pin.txt"
driven "$out/pin.txt" "a loop that is turned" "in.loop_0.value[0] = $versine; in.loop_0.rate[0] = $its_rate;" 's.body_0.x[0], m.body_1.speed[0], e.kinetic'
# two links pinned to each other stand still: a wheel that is driven elsewhere makes it no contradiction
lines "$run rk4;body crank rigid;hub 2 0.3 0 0 0.1 0.1 0.1;end;body rod rigid;hub 1 0.5 0 0 0.05 0.1 0.1;end;body wheel rigid;hub 1 0.2 0 0 0.05 0.05 0.05;end;joint foot revolute ground crank;attitude z 30 x 17;stiffness 1000;start 1 0.9272952180016122;end" \
  "joint knee revolute ground rod;position 0.7794228634059948 0.45 0;attitude z 30 x 17;start 1 2.214297435588181;end;joint far revolute ground wheel;mode prescribed;rate 1 versine 0.5 0 0.2;end" \
  "loop pin revolute crank rod;position 0.75 0 0;child_position 0.75 0 0;end;output angle coordinate foot 1;output speed speed far 1;output energy energy kinetic" > "$out/rest.txt"
driven "$out/rest.txt" "a loop at rest" "in.body_2.value[0] = $versine; in.body_2.rate[0] = $its_rate;" 's.body_0.x[0], m.body_2.speed[0], e.kinetic'
# a satellite in a low orbit, whose boom swings on a hinge by the gradient of gravity
center="central_gravity 3.986004418e14 -7e6 0 0"
lines "duration 800;step 0.8;integrator rk4;body hub rigid;hub 500 0 0 0 200 300 350;node 0.5 0 0 side;$center;start_attitude z 30;start_velocity 0 7546.0532887 0;start_spin 0 0 0.001078007612872506;end" \
  "body boom beam;length 30;stations x mass EI_y EI_z;0 0.3 2500 2500;end;modes bend_y 1 bend_z 1;effects full;$center;end;joint hinge revolute hub.side boom;stiffness 0.02;start 1 0.2;end" \
  "output angle coordinate hinge 1;output side position hub y;output energy energy total" > "$out/orbit.txt"
driven "$out/orbit.txt" "a low orbit" "" 's.body_1.x[0], m.body_0.position[1], e.kinetic + e.strain + e.gravity' 1000 0.8
# one body on a free joint, by sdirk
lines "duration 0.1;step 0.0001;integrator sdirk;body hub beam;length 4;stations x mass EI_y EI_z;0 3 400 3000;end;hub 800 0 0 0 400 300 500;modes bend_y 2;damping 0.01;effects full damping;start_mode 1 0.01;start_spin 0.1 0.2 0.05;end" \
  "joint base free ground hub;end;output q mode hub 1;output r mode hub 2;output energy energy kinetic" > "$out/one.txt"
driven "$out/one.txt" "one body by sdirk" "" 's.body_0.q[0], s.body_0.q[1], e.kinetic' 1000 1e-4

# scene TEXT...: hub and array, with other lines at the end; $line in its joint
scene() {
  lines "duration 1;body hub rigid;hub 800 0 0 0 400 300 500;node 0.8 0 0 side;end;body array beam;length 4;stations x mass EI_y EI_z GJ i_z;0 3 400 3000 200 0.25;end;hub 2 0 0 0 0.1 0.1 0.1" \
    "modes bend_y 3;damping 0.005;effects ${effects:-full damping};node tip tip;end;joint hinge revolute hub.side array;stiffness 3;damping 0.05${line:+;$line};end" "$@" > "$out/scene.txt"
}
effects=
tail="body tail rigid;hub 1 0 0 0 1 1 2;end;joint end revolute array.tip tail;end;loop pin spherical hub array.tip;position 4.8 0 0;end"
scene
written "$out/scene.txt"
try build/flexbeam scene "$out/scene.txt" --code "$out/generated.h"
grep -q 'integrator auto: the step is that of rk4' "$out/log" || fail "integrator auto: $(cat "$out/log")"
grep -q 'body_1: array, 3 modes, revolute on hub' "$out/generated.h" || fail "the head of a scene's step"
for parts in "integrator sdirk;step 0.01" "spring strut hub array.tip;stiffness 1;length 3;damping 0.1;end" "$tail;rotor fly array;axis 1 0 0;inertia 0.1;end" "body alone rigid;hub 1 0 0 0 1 1 1;end;rotor fly hub;axis 1 0 0;inertia 0.1;static_imbalance 1e-4;end" \
  "loop pin spherical ground array.tip;position 4.8 0 0;end" "body tail rigid;hub 1 0 0 0 1 1 1;end;joint end universal hub tail;mode free prescribed;end"; do
  scene "$parts"
  written "$out/scene.txt"
  case $parts in
  integrator*) grep -q 'their step of sdirk: fb_system_sdirk_step' "$out/generated.h" || fail "the head of a step of SDIRK" ;;
  *ground*) ! grep -q 'lost_u' "$out/generated.h" || fail "a frame that stands still has a velocity" ;;
  esac
done
scene "$(for k in 1 2 3 4 5 6 7 8; do echo "body ball$k rigid;hub 1 0 0 0 1 1.1 1.2;end;joint ball$k spherical hub ball$k;end"; done)"
written "$out/scene.txt"
lines "duration 1;body hub beam;length 4;stations x mass EI_y EI_z;0 3 400 3000;end;modes bend_y 2;end;joint weld rigid ground hub;end" > "$out/clamped.txt"
written "$out/clamped.txt"
effects="large damping" scene "$tail"
written "$out/scene.txt" --lanes --loads array.tip
scene "spring strut hub array.tip;stiffness 1;length 3;end;output angle coordinate hinge 1;control rein;sample 0.01;input angle;pid 1 0 0;output pull strut;end"
written "$out/scene.txt"
grep -q 'double pull_0;' "$out/generated.h" || fail "a controlled actuator is no input"
written examples/scenes/squeezer.txt # links so light that the library steps states near the start alone
for mode in locked prescribed; do
  line="mode $mode" scene
  written "$out/scene.txt"
done
scene "load array.tip base force 1 0 0;load hub.side dead torque 1 0 0;load hub base force 1 0 0"
written "$out/scene.txt" --loads hub.side,array.tip,hub
[ "$(grep -c 'force_1\[3\]\|torque_1\[3\]' "$out/generated.h")" = 4 ] || fail "loads at nodes are no inputs"

# refuse WORDS COMMAND...: nothing is written
refused=0
refuse() {
  what=$1
  shift
  ! "$@" > "$out/log" 2>&1 || fail "$what: taken"
  grep -q -e "$what" "$out/log" || fail "$what: $(tail -n 1 "$out/log")"
  [ ! -e "$out/none.h" ] && [ ! -e "$out/none.csv" ] || fail "$what: a file is written"
  refused=$((refused + 1))
}
code="build/flexbeam scene $out/scene.txt --code $out/none.h"
refuse "load and nudge: the caller gives them as input, by --loads hub.side,hub (line" $code --loads array.tip
refuse "a name is missing; choose BODY.NODE, or BODY for its origin" $code --loads ""
refuse "a name is missing" $code --loads hub.side,
refuse "hub.none: body hub has no such node; it has 1 or side, and hub alone is its origin" $code --loads hub.none
refuse "none.side: there is no body none" $code --loads none.side
refuse "hub.side: named twice" $code --loads hub.side,hub.side
refuse "--loads belongs to --code" build/flexbeam scene "$out/scene.txt" --loads hub
scene "event 1 lock hinge 1;load hub base force 1 0 0"
refuse "--code: load and nudge: .* (line [0-9]*); event: .* (line [0-9]*)" $code
scene "joint base free ground hub;mode locked;end"
refuse "hub: a free joint that is locked or prescribed" $code
scene
for word in 9 fb_step; do
  refuse "C identifier" build/flexbeam scene "$out/scene.txt" --code "$out/$word.h"
done
refuse "--single belongs to --code" build/flexbeam scene "$out/scene.txt" --single
refuse "--code runs nothing" $code --out "$out/none.csv"
refuse "central_gravity of bodies on joints in single precision" build/flexbeam scene "$out/orbit.txt" --single --code "$out/none.h"
hub="duration 1;body hub rigid;hub 800 0 0 0 400 300 500;end"
lines "$hub;joint weld rigid ground hub;end" > "$out/scene.txt"
refuse "nothing can move" $code
lines "$hub;joint turn revolute ground hub;mode prescribed;end" > "$out/scene.txt"
refuse "nothing can move by itself" $code
lines "$hub" > "$out/scene.txt"
refuse "one body without a joint" $code
lines "$hub;body arm rigid;hub 1 0 0 0 1 1 1;end;joint foot revolute ground hub;end;joint knee revolute hub arm;position 1 0 0;end;loop pin revolute hub arm;position 1 0 0;motor 1 constant 1;end" > "$out/scene.txt"
refuse "motor of a loop: choose one on a joint of the tree (line" $code

# of reduce: a body with a hub and a damped boom, each with one thing that does not go
body() {
  lines "beam;length 10;elements 3;hub 50 0 0 0 20 30 40;stations x mass EI_y EI_z GJ EA i_y i_z;0 1.2 14004 14004 2000 1e6 0.01 0.01;end;modes bend_y 2;effects full damping;damping 0.01;base free;node tip" | sed "${1:-}" > "$out/body.txt"
}
code="build/flexbeam reduce $out/body.txt --out $out/none.h"
body
for list in stiffness,weight mass,mass ""; do
  refuse "wants names" $code --code --vary "$list"
done
refuse "all names at once" $code --code --vary stiffness --vary mass
refuse "an option of --code" $code --vary mass
refuse "--lanes is an option of --code" $code --lanes
for list in 0 origin; do
  refuse "the load on the origin is an input anyway" $code --code --loads $list
done
refuse "there is no such node; choose 1 to .*: nowhere" $code --code --loads nowhere
refuse "a node is named twice" $code --code --loads 1,1
refuse "a name is missing" $code --code --loads 1,
refuse "an option of --code" $code --single --loads 1
body 's/^effects.*/effects large damping/'
refuse "stiffness and damping only" $code --code --vary stiffness,mass
body 's/^hub.*//'
refuse "which the description has not" $code --code --vary hub_mass
body 's/^effects.*/effects full/; s/^damping.*//'
refuse "the body has none" $code --code --vary damping
body 's/^modes/spin 1 0\nmodes/'
refuse "modes at rest" $code --code --vary stiffness
lines "rigid;hub 5 0 0 0 1 1 1;base free" > "$out/body.txt"
refuse "choose hub_mass" $code --code --vary mass
refuse "has no modes" $code --code --vary stiffness
refuse "with rotors varies" build/flexbeam reduce examples/satellite_wheels.txt --code --vary mass --out "$out/none.h"
ok "$ways steps of scenes end where the scenes do, $number are written and compile; $refused things that cannot be written are refused by name"
