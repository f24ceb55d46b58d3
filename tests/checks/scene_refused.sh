# scene_refused.sh - malformed scenes, for scene.sh: the line and the reason that each must be refused with.
refuse 0 "a scene wants a body" << END
duration 1
END
refuse 0 "a scene wants a duration, or to trim" << END
$top
END
refuse 1 "no such word: durration" << END
durration 1
END
refuse 2 "duration is there twice" << END
duration 1
duration 2
END
refuse 1 "duration must be greater than 0" << END
duration -1
END
refuse 1 "duration is not a number: long" << END
duration long
END
refuse 1 "duration is not a number: 2*" << END
duration 2*
END
refuse 1 "duration is not a number: 2/0" << END
duration 2/0
END
refuse 1 "too much on the line: 2" << END
duration 1 2
END
refuse 2 "no parameter has the name late" << 'END'
parameter later 1
duration $late
END
refuse 2 "two parameters have the name a" << END
parameter a 1
parameter a 2
END
refuse 2 "nothing uses parameter spin: no number is \$spin" << END
duration 1
parameter spin 6     rad/s
$top
END
refuse 1 "the name of a parameter has letters" << END
parameter 1a 1
END
refuse 1 "integrator must be one of rk4" << END
integrator euler
END
refuse 1 "a body must be one of beam" << END
body a plate
END
refuse 1 "no body has the name b" << END
body a like b
END
refuse 2 "no beam before it has the name b" << END
body a parts
  beam c like b  0 0 0
end
END
refuse 5 "no rotor has the name w" << END
$top
rotor v like w  0 0 1
END
refuse 9 "rotor v wants an axis, not zero" << END
$top
rotor w top
  axis 0 0 1
  inertia 1
end
rotor v like w  0 0 0
END
refuse 3 "no such word for a rigid body: duration" << END
body a rigid
  hub 1 0 0 0 1 1 1
duration 1
END
refuse 2 "body a of line 1 wants a line \`end\`" << END
body a rigid
  hub 1 0 0 0 1 1 1
END
# an `end` that is missing is told where it shows; not where all are there
refuse 4 "no such word for a rigid body: joint (inside body craft of line 2: a line \`end\` is missing)" << END
duration 1
body craft rigid
  hub 1 0 0 0 1 1 1
joint j revolute ground craft
end
END
refuse 6 "the motor of a rotor is not in its description: a scene has one, or a program (inside rotor w of line 3, body craft of line 1: a" << END
body craft rigid
  hub 1 0 0 0 1 1 1
rotor w craft
  axis 0 0 1
  inertia 1
  motor constant 1
end
END
refuse 5 "x is not a number: modes (inside table of stations of line 3, body b of line 1: a line \`end\` is missing)" << END
body b beam
  length 1
  stations x mass EI_y
    0 1 1
  modes bend_y 1
end
END
refuse 4 "no such word for a rotor: rotor (inside rotor w of line 2, body b of line 1: a line" << END
body b rigid
  rotor w
    axis 0 0 1
  rotor v
    axis 0 0 1
  end
end
END
sole() {
  refuse "$@"
  ! grep -q missing "$out/log" || fail "an end is missed that is there: $(cat "$out/log")"
}
sole 3 "no such word for a rotor: spin" << END
body b parts
  rotor w # without an end it would be another one's
    spin 3
  end
  beam boom
    stations x mass
    end # of the table
  end
end
joint j revolute ground b
end
END
sole 5 "no such word for a beam: nod" << END
body b parts
  hub 1 0 0 0 1 1 1
  beam one
    length 1
    nod tip
  end
  beam two like one  1 0 0
end
rotor w b
  axis 0 0 1
  inertia 1
end
rotor v like w  1 0 0
END
sole 2 "damping wants 1 or 6 numbers, not 2" << END
body b exact
  damping 0.1 0.2
end
END
sole 2 "damping_ratio wants a ratio from 0 and a frequency above 0 Hz, not 0.02, 0" << END
body b exact
  damping_ratio 0.02 0
end
END
sole 2 "no such word for an exact beam: lenght" << END
body b exact
  lenght 1
  joint 0.5 revolute
end
END
refuse 4 "table of stations of line 3 wants a line \`end\` (inside body b of line 1: a line \`end\` is missing)" << END
body b beam
  length 1
  stations x mass EI_y
    0 1 1
END
refuse 2 "hub mass center, number 1 of 3 is not a number: 0,1 (a decimal point, or blanks between numbers, not a comma)" << END
body b rigid
  hub 250 0,1 0  50 55 70
end
END
refuse 6 "no such word: start_velocity; it belongs between \`body\` and its \`end\`" << END
# commas and blanks between numbers; one in words
title a boom of 2,5 m
body b rigid
  hub 250, 0, 0, 0,  50, 55, 70
end
start_velocity 1 0 0
END
refuse 6 "no output has the name w: of its components take w_x w_y w_z" << END
$top
output w spin top
measure m max w
END
refuse 0 "trim: no steady state: loads or gravity push" << END
$top
trim
load top.tip dead force 1 0 0
END
refuse 10 "trim: no steady state: this value moves at 0 s, at a rate of 0.314159 that changes" << END
trim
body hub rigid
  hub 1  0 0 0  1 1 1
end
body blade rigid
  hub 1  0 0 0  1 1 1
end
joint pitch revolute hub blade
  axis 1 0 0
  value 1 sine 0.05 1
end
joint spin revolute ground hub
  rate 1 constant 6
end
END
refuse 2 "a beam wants stations or taper" << END
# the line of the body: what is missing has none
body a beam
  length 1
end
END
refuse 3 "GA_y and GA_z" << END
body a beam
  stations x mass GA_y
    0 1 5
  end
end
END
refuse 2 "no such word for a beam: lenght" << END
body a beam
  lenght 1
end
END
refuse 1 "$out/nothing.txt: No such file" << END
body a file nothing.txt
end
END
refuse 10 "two bodies have the name beam" << END
$beam
body beam rigid
end
END
refuse 1 "a gauge: a value is out of its range" << END
body beam beam
  length 10
  stations x mass EI_z
    0 1.2 14004
  end
  modes bend_y 2
  gauge far 20 0 0
end
END
refuse 5 "force, number 3 of 3 is missing" << END
$top
load top dead force 1 0
END
refuse 5 "body top has no node top" << END
$top
load top.top dead force 1 0 0
END
refuse 5 "no body has the name tip" << END
$top
load tip dead force 1 0 0
END
refuse 5 "axes of a load must be one of dead follower base, is sideways" << END
$top
load top sideways force 1 0 0
END
refuse 5 "a function must end after it begins" << END
$top
load top dead force 1 0 0 ramp 1 2 1
END
refuse 5 "the frequency of a sine must be greater than 0" << END
$top
load top dead force 1 0 0 sine 1 0
END
refuse 5 "the times of a table must ascend" << END
$top
load top dead force 1 0 0 table 0 1 0 2
END
refuse 5 "$out/no.csv: No such file" << END
$top
load top dead force 1 0 0 file no.csv t x
END
refuse 5 "$out/../../../tests/reference/p10_symmetric_top.csv has no column w4" << END
$top
load top dead force 1 0 0 file ../../../tests/reference/p10_symmetric_top.csv t w4
END
refuse 5 "a function must be one of constant" << END
$top
load top dead force 1 0 0 wiggle
END
refuse 5 "the axis must be one of x y z, is w" << END
$top
output a position top.tip w
END
refuse 6 "two outputs have the name a" << END
$top
output a position top x
output a position top y
END
refuse 10 "mode must be a whole number from 1 to 2" << END
$beam
output a mode beam 3
END
refuse 5 "internal_force is of nodes on beams" << END
$top
output a internal_force top x
END
refuse 3 "output m_x: internal_moment is of beams with large deflection" << END
duration 1
interval 0.5
body strip beam
  length 1
  elements 2
  stations x mass EI_z
    0 1 1
  end
  modes bend_y 2
  base prescribed
  node tip tip
end
output m internal_moment strip.tip
END
refuse 5 "no output has the name a" << END
$top
measure m max a
END
refuse 6 "expected after, is from" << END
$top
output a position top x
measure m max a from 3
END
refuse 5 "no measure has the name m" << END
$top
expect m 1 tolerance 1
END
refuse 7 "a tolerance must be greater than 0" << END
$top
output a position top x
measure m max a
expect m 1 tolerance 0
END
refuse 5 "a joint must be one of free rigid" << END
$top
joint j hinge ground top
end
END
refuse 5 "body top hangs on top, which must stand before it" << END
$top
joint j revolute top top
end
END
refuse 6 "number of the axis must be a whole number from 1 to 1" << END
$top
joint j revolute ground top
  motor 2 constant 1
end
END
refuse 6 "the axis of a joint must not be zero" << END
$top
joint j revolute ground top
  axis 0 0 0
end
END
refuse 6 "the lower stop comes first" << END
$top
joint j revolute ground top
  stops 1 2 1 stiffness 3
end
END
refuse 6 "stops end in: stiffness K, maybe loss C" << END
$top
joint j revolute ground top
  stops 1 -1 1
end
END
refuse 6 "the stiffness of stops must be positive" << END
$top
joint j revolute ground top
  stops 1 -1 1 stiffness 0
end
END
refuse 6 "the loss of stops must not be negative" << END
$top
joint j revolute ground top
  stops 1 -1 1 stiffness 2 loss -1
end
END
refuse 6 "friction_speed is negative" << END
$top
joint j revolute ground top
  friction_speed -3
end
END
refuse 7 "stops 1 is there twice" << END
$top
joint j revolute ground top
  stops 1 -1 1 stiffness 2
  stops 1 -1 1 stiffness 2
end
END
refuse 5 "a body hangs by its origin" << END
$top
joint j revolute ground top.tip
end
END
refuse 7 "body top hangs by j already" << END
$top
joint j revolute ground top
end
joint k revolute ground top
end
END
refuse 5 "joint j of line 5 wants a line \`end\`" << END
$top
joint j revolute ground top
END
refuse 8 "events stand in the order of their times" << END
$top
joint j revolute ground top
end
event 2 lock j 1
event 1 free j 1
END
refuse 7 "motion is that of a single body's base" << END
$top
joint j revolute ground top
end
motion rate 0 0 1
duration 1
END
refuse 7 "integrator of bodies on joints is rk4 or sdirk" << END
$top
joint j revolute ground top
end
integrator exponential
duration 1
END
refuse 5 "gravity must stand before the bodies" << END
$top
gravity 0 0 -9.81
END
refuse 4 "stiffness wants 6, 21 or 36 numbers, not 3" << END
body a exact
  length 1
  station 0
  stiffness 1 2 3
end
END
refuse 7 "an exact beam has no output acceleration" << END
body a exact
  length 1
  station 0
  stiffness 0 0 0 0 0 1
  mass 1
end
output a acceleration a x
END
refuse 2 "exact takes a straight beam" << END
exact 3
$top
END
refuse 1 "units wants a name" << END
units m
END
# csv REASON CONTENT: a table that is refused
csv() {
  printf "$2" > "$out/table.csv"
  refuse 5 "$out/table.csv$1" << END
$top
load top dead force 1 0 0 file table.csv t x
END
}
csv ":2: column 2 is not a number: a" 't,x\n0,a\n'
csv ":2: column 2 is not a number: missing" 't,x\n0\n'
csv ":2: column 1 is not a number: 0,5" 't;x\n0,5;1\n'
csv ":2: column 2 is not a number: 2,5" 't,x\n0,"2,5"\n'
csv " has no column x" 't,y\n0,1\n'
csv " is empty" '# t,x\n'
csv " has no rows" 't,x\n'
csv ":1: is no text" '\000\001\002t,x\n0,1\n'
csv ":2: is no text" 't,x\n0\000,1\n'
csv ":2: the line is longer than 16382 characters" "t,x\\n$(printf '%020000d' 0),1\\n"
refuse 7 "its modes: a kind of deformation has no stiffness or no inertia" << END
body a beam
  length 1
  stations x mass EI_z
    0 1 1
  end
  base prescribed
  modes axial 2
end
END
refuse 6 "no mode is left" << END
body a beam
  length 1
  stations x mass EI_z
    0 1 1
  end
  modes bend_y 0
end
END
refuse 7 "damping wants one ratio, or as many as there are modes" << END
body a beam
  length 1
  stations x mass EI_z
    0 1 1
  end
  effects full damping
  damping 0.1 0.2 0.3
  modes bend_y 2
end
END
# what is written is used, and contradicts nothing else
# exact LINE REASON < FILE: line 1 is the first behind the station of an exact beam
exact() {
  { printf 'gravity 0 0 -9.81\nbody a exact\n  length 1\n  station 0\n  stiffness 0 0 0 0 0 1\n  mass 1\n'; cat; } > "$out/exact.txt"
  printf 'end\nduration 1\n' >> "$out/exact.txt"
  refuse $(($1 + 6)) "$2" < "$out/exact.txt"
}
exact 1 "gravity of a body under that of the scene" << END
  gravity 0 0 -1
END
exact 1 "modes of an exact beam are not printed here" << END
  modes 3
END
exact 2 "root is there twice" << END
  root free
  root clamped
END
exact 2 "start_spin of a clamped root" << END
  node tip
  start_spin 0 0 1
END
exact 2 "tip belongs to the beam that branches begin on" << END
  branch 1
  tip pinned
END
exact 1 "the first branch begins on the beam" << END
  branch 0 1
END
exact 4 "gravity of a body under that of the scene" << END
  branch 0
  attitude 0 0 90
  length 2
  gravity 0 0 -1
END
exact 1 "an exact beam has no modes" << END
  start_mode 2 1
END
# supports that move: beyond the root, held in that direction, from where they are built or from a steady state
exact 2 "nothing holds the beam there" << END
  node tip
  move 0.5 0 0 0.1
END
exact 2 "the root is held by its base" << END
  tip z
  move 0 0 0 0.1
END
exact 3 "x is not held there and cannot be moved" << END
  tip z
  node tip
  move tip 0.1 0 0
END
exact 2 "rotation vector x y z in degrees is missing" << END
  tip clamped
  move tip 0.1 0 0 10
END
exact 2 "displacement x y z, number 3 of 3 is missing" << END
  tip clamped
  move tip 0.1 0
END
exact 2 "a support that is moved at 1.2 is not on the beam" << END
  tip z
  move 1.2 0 0 0.1
END
exact 3 "line 8 moves what holds the beam there already" << END
  tip z
  move tip 0 0 0.1
  move 1 0 0 0.2
END
refuse 7 "supports that are not where they are built at the start want a line trim" << END
body a exact
  length 1
  station 0
  stiffness 0 0 0 0 0 1
  mass 1
  tip z
  move tip 0 0 0.1
end
duration 1
END
# motion LINE REASON < FILE: line 1 is behind that beam, whose tip is held along z
motion() {
  { printf 'body a exact\n  length 1\n  station 0\n  stiffness 0 0 0 0 0 1\n  mass 1\n  tip z\n  node 0.5 mid\n  node tip tip\nend\nduration 1\n'; cat; } > "$out/motion.txt"
  refuse $(($1 + 10)) "$2" < "$out/motion.txt"
}
motion 1 "y is not held there and cannot be moved" << END
motion displacement a.tip 0 1 0
END
motion 1 "rz is not held there and cannot be moved" << END
motion rotation a.tip 0 0 1
END
motion 1 "nothing holds the beam there" << END
motion displacement a.mid 0 0 1
END
motion 1 "the root is held by its base" << END
motion displacement a 0 0 1
END
refuse 10 "displacement and rotation are of supports of an exact beam" << END
$beam
motion displacement beam 0 0 1
END
exact 1 "auto is that of bodies with modes" << END
  auto 0.1
END
exact 1 "gauge is that of beams with modes" << END
  gauge g 0 0 0
END
refuse 3 "the body has 0 modes" << END
body b rigid
  hub 1  0 0 0  1 1 1
  start_mode 9 0.1
end
duration 1
END
for word in velocity spin; do
  refuse 9 "start_$word of a prescribed base: it moves as \`motion\` says" << END
${beam%end}
  start_$word 0 0 1
end
duration 1
END
done
for word in position velocity attitude spin; do
  refuse 4 "start_$word of a body on a joint" << END
${top%end}
  start_$word 0 0 1 $([ $word != attitude ] || echo 0)
end
joint j revolute ground top
end
duration 1
END
done
refuse 5 "start_spin is there twice" << END
${top%end}
  start_spin 1 0 0
  start_spin 0 1 0
end
END
refuse 4 "start_spin on a joint that is not free" << END
${top%end}
  start_spin 1 0 0
end
joint j free ground top
  rate 6 constant 1
end
duration 1
END
refuse 4 "gravity of a body under that of the scene" << END
gravity 0 0 -9.81
body b rigid
  hub 1  0 0 0  1 1 1
  gravity 0 0 -1
  effects rigid gravity
end
END
refuse 3 "central_gravity wants mu above 0, then its center x y z" << END
body b rigid
  hub 1  0 0 0  1 1 1
  central_gravity -5  0 0 9
end
END
refuse 3 "the center, number 3 of 3 is missing" << END
body b rigid
  hub 1  0 0 0  1 1 1
  central_gravity 5  0 0
end
END
refuse 1 "trim of bodies on joints does not know central_gravity" << END
trim
body b rigid
  hub 1  0 0 0  1 1 1
  central_gravity 5  0 0 9
end
joint j free ground b
end
output x position b x
END
refuse 2 "central_gravity of body b wants a step" << END
duration 1
body b rigid
  hub 1  0 0 0  1 1 1
  central_gravity 5  0 0 9
end
joint j free ground b
end
output x position b x
END
refuse 2 "the effect gravity wants a line gravity x y z" << END
body b rigid
  effects rigid gravity
  hub 1  0 0 0  1 1 1
end
END
refuse 5 "motion wants a body with \`base prescribed\`" << END
$top
motion rate 0 0 1
duration 1
END
refuse 5 "method is that of bodies on joints" << END
$top
method dense
duration 1
END
# an axis LINE REASON < FILE: line 1 is the first of a joint
axis() {
  { echo "$top"; echo 'joint j revolute ground top'; cat; printf 'end\nduration 1\n'; } > "$out/axis.txt"
  refuse $(($1 + 5)) "$2" < "$out/axis.txt"
}
axis 1 "value and rate of the same axis: one of them" << END
  value 1 ramp 1 0 1
  rate 1 constant 1
END
axis 2 "a value on an axis with a start: one of them, or rate" << END
  start 1 0.3
  value 1 ramp 1 0 1
END
axis 1 "a value must not jump: take ramp or smooth" << END
  value 1 step 1 0.5
END
axis 2 "a motor on an axis that is not free" << END
  mode locked
  motor 1 constant 1
END
axis 1 "a motor on an axis that is not free" << END
  motor 1 constant 1
  rate 1 constant 1
END
axis 1 "a value or rate on an axis that is not prescribed" << END
  rate 1 constant 1
  mode free
END
axis 2 "a speed at the start of an axis that is not free" << END
  mode locked
  start 1 0.3 5
END
axis 2 "start 1 is there twice" << END
  start 1 0.3
  start 1 0.4
END
axis 2 "damping is there twice" << END
  damping 1
  damping 2
END
axis 1 "stiffness is negative" << END
  stiffness -1
END
axis 1 "damping is negative" << END
  damping -1
END
axis 1 "pitch is that of a screw" << END
  pitch 1
END
axis 4 "a loop follows the joints of the tree: start those" << END
  damping 1
end
loop k revolute ground top.tip
  start 1 0.2
END
refuse 3 "bend_y is there twice" << END
body a beam
  length 1
  modes bend_y 2 bend_y 2
end
END
refuse 3 "points must be a whole number from 2 to 32" << END
body a beam
  length 1
  modes bend_y 2 points 33
end
END
refuse 4 "an effect must be one of rigid" << END
body a beam
  length 1
  modes bend_y 2
  effects larger
end
END
# an integrator that does not step large deflection says so, or meets what the scene asks for
sed 's/^gravity/integrator sdirk\ngravity/' examples/scenes/large_drop.txt > "$out/implicit.txt"
build/flexbeam scene "$out/implicit.txt" --quiet > "$out/log" 2>&1 || grep -q 'large deflection\|MISSED' "$out/log" ||
  fail "large deflection by sdirk: $(cat "$out/log")"
refuse 3 "an attitude must not be zero" << END
body a beam
  length 1
  attitude 0 0 0 0
end
END
refuse 1 "ground is what is at rest: no name of a body" << END
body ground rigid
end
END
refuse 7 "after 99 s: the duration is 1 s" << END
$top
output k energy total
duration 1
measure m max k after 99
END
refuse 7 "two measures have the name m" << END
$top
output k energy total
measure m max k
measure m min k
END
refuse 5 "t is the column of the time: no name of an output" << END
$top
output t energy total
END
refuse 5 "method (joints as constraints: loop, on free bodies) must be one of recursive dense, is multipliers" << END
$top
method multipliers
duration 1
END
refuse 3 "no body has this inertia: each principal one is at most the sum of the other two" << END
body b rigid
  node 0 0 1 tip
  hub 1  0 0 0  1 1 3
end
END
refuse 3 "the table wants a column mass" << END
body b beam
  length 1
  stations x EI_z
    0 1
  end
end
END
refuse 3 "the mass of a lump is negative" << END
body b beam
  length 1
  lump 3 -1  0 0 0  0 0 0
end
END
refuse 3 "auto wants a node" << END
body top rigid
  hub 1  0 0 0  1 2 3
  auto 0.1
end
duration 1
END
refuse 1 "body b is free and has no mass" << END
body b rigid
  node 0 0 1 tip
end
duration 1
END
refuse 7 "start: constraints contradict each other, or a loop cannot be closed (joint k)" << END
body a rigid
  hub 1  0 0 0  1 1 1
  node 1 0 0 tip
end
joint j revolute ground a
end
loop k revolute ground a.tip
  position 5 0 0
end
duration 1
step 0.01
END
fails "at 0 s, step of 0.5 s: the step is longer" << END
$beam
duration 10
interval 0.5
step 0.5
load beam.tip dead force 0 1 0
END
refuse 0 "steps of 1e-19 s are 1e+19 or more in 1 s" << END
$top
duration 1
interval 0.1
step 1e-19
END
refuse 0 "body b of line 2: a force on its origin, and the exact beam begins elsewhere" << END
exact 2
body b beam
  length 1
  stations x mass EI_z
    0 1 1
  end
  position 1 0 0
  base prescribed
  modes bend_y 1
end
load b dead force 0 1 0
duration 1
END
# forms: their words, and the effects and integrators that they go with
# form LINE REASON LINES [OF THE SCENE]: of a beam, base prescribed, with those lines among its own
form() {
  refuse "$1" "$2" << END
$(echo "$beam" | sed '$d')
$3
end
${4-}
duration 1
END
}
form 9 "form must be one of momentum second first, is third" "form third"
form 9 "form must be one of momentum second first, is missing" "form"
form 9 "stiffness torque must be one of identity printed boundary, is exact" "form first exact"
form 9 "too much on the line: printed" "form second printed"
form 10 "form is there twice" "form second
form second"
form 9 "form first has no quadratic displacement: effects strain, spin or linear" "form first"
form 9 "form first with a stiffness torque of that kind wants effects strain" "form first printed
effects spin"
form 9 "form second wants both of spin_coupling and residual_inertia, or neither" "form second
effects spin"
form 9 "highest degree must be a whole number from 0 to 3" "truncate 4"
form 10 "truncate wants effects that are not half of something" "effects residual_inertia spin_coupling
truncate 2"
form 10 "auto chooses among effects of the momentum form, not truncated" "form second
auto 0.01"
form 11 "integrator exponential moves the momentum form alone" "form second" "
integrator exponential"
refuse 4 "form is that of bodies with modes" << END
body b exact
  length 1
  station 0
  form second
    stiffness 0 0 0 0 0 1
end
trim
END
refuse 8 "form is that of a body alone: joints want momentum" << END
$(echo "$beam" | sed -e '$d' -e '/base/d')
  form second
end
joint j revolute ground beam
end
duration 1
END
form 10 "cubic is there twice" "cubic
cubic"
form 9 "too much on the line: 3" "cubic 3"
form 10 "cubic is of natural and component modes: functions have a degree" "functions 3
cubic"
refuse 1 "a unit has none of < > &" << END
units m< N
END
refuse 6 "nudge is that of an exact beam" << END
$top
trim
nudge top dead force 0 1 0
END
column='body column exact
  length 1
  station 0
    stiffness 0 0 0 0 0 1
  node tip tip
end'
refuse 8 "nudge wants trim" << END
$column
duration 1
nudge column.tip dead force 0 1 0
END
refuse 8 "too much on the line: ramp" << END
$column
trim
nudge column.tip dead force 0 1 0 ramp 1 0 1
END
refuse 8 "force, number 3 of 3 is missing" << END
$column
trim
nudge column.tip dead force 0 1
END
refuse 8 "no body has the name beam" << END
$column
trim
nudge beam.tip dead force 0 1 0
END
# what is warned of, and counts as missed or not
warned "goes through 6.3 rad in a step of at most 0.1 s" 0 << END
$top
load top dead force 1 0 0 sine 1 10
duration 1
interval 0.5
step 0.1
END
warned "auto of body beam: estimated error .* %, beyond the allowed .* MISSED" 1 << END
$(echo "$beam" | sed 's/^end/  auto 1e-3\nend/')
motion rate 0 0 35 smooth 0.5 0 1
duration 1
END
# loosely LINE REASON < FILE: a beam on a joint, the lines of its body, then of the joint
loosely() {
  { printf 'duration 1\nbody b beam\n  length 1\n  stations x mass EI_z\n    0 1 1\n  end\n  modes bend_y 1\n'; cat; echo end; } > "$out/loosely.txt"
  refuse $(($1 + 7)) "$2" < "$out/loosely.txt"
}
pinned="a moment about axis 1 of joint h does not bend body b, which has modes of a pinned root: root clamped and a hub, or effects large"
for moment in "stiffness 2" "damping 0.1" "friction 1" "motor 1 constant 1" "mode locked" "stops 1 -1 1 stiffness 10"; do
  printf '  root pinned\nend\njoint h revolute ground b\n  %s\n' "$moment" | loosely 4 "$pinned"
done
loosely 5 "$pinned" << END
  root pinned
end
joint h revolute ground b
end
event 0.5 lock h 1
body c rigid
  hub 1  0 0 0  1 1 1
END
loosely 3 "modes of a pinned root leave out how body b moves on this joint: root clamped" << END
  root pinned
end
joint h prismatic ground b
END
loosely 3 "modes of a pinned root leave out how body b moves on this joint: root clamped" << END
  root pinned
end
joint h revolute ground b
  axis 0 1 0
END
loosely 3 "modes of a free root leave out how body b moves on this joint: root clamped" << END
  root free
end
joint h revolute ground b
END
loosely 1 "modes of a pinned root leave out how it turns against its hub: root clamped" << END
  root pinned
  hub 1  0 0 0  1 1 1
END
loosely 1 "modes of a free root are those of a beam that flies alone, held by no base: its hub is a line \`lump 0 ..\`, or root clamped" << END
  root free
  base hinged
END
# exactly LINE REASON < FILE: a beam of modes that the exact one would not be
exactly() {
  { printf 'exact 5\nduration 1\nbody b beam\n  length 1\n  stations x mass EI_z\n    0 1 1\n  end\n  modes bend_y 1\n'; cat; echo end; } > "$out/exactly.txt"
  refuse $(($1 + 8)) "$2" < "$out/exactly.txt"
}
exactly 1 "an exact beam is clamped to its body, which \`base\` holds" << END
  root pinned
END
exactly 2 "modes of a free root are those of a beam that flies alone, held by no hub: its hub is a line \`lump 0 ..\`, or root clamped" << END
  hub 1  0 0 0  1 1 1
  root free
END
exactly 2 "an exact beam on a pin or hinge turns about its root: no position" << END
  base hinged
  position 0.1 0 0
END
exactly 1 "the hinge of an exact beam is along its own z" << END
  attitude 1 0.1 0 0
  base hinged
END
exactly 2 "preload is that of modes: give an exact beam the loads themselves" << END
  base prescribed
  preload 10 0 0 0
END
refuse 5 "a body is wanted, not tip of it" << END
$top
output a spin top.tip z
END
refuse 5 "a body is wanted, not tip of it" << END
$top
view top top.tip
END
refuse 1 "step is not a number: automatic" << END
step automatic
END
refuse 4 "the node's place is not a number: tips" << END
body b beam
  length 1
  modes bend_y 1
  node tips
end
END
refuse 4 "the node's place is not a number: tips" << END
body b exact
  length 1
  station 0
  node tips
end
END
refuse 1 "two nodes have the name a" << END
body b exact
  length 1
  station 0
    stiffness 0 0 0 0 0 1
    mass 1
  node 0.5 a
  node tip a
end
END
refuse 6 "node 3 is marked twice" << END
body b component
  modes 1
  frequency_hz 1
  node 3  0 0 0  1
  mark 3 a
  mark 3 b
end
END
refuse 3 "two gauges have the name g" << END
body b beam
  gauge g 0 0 1
  gauge g 0 1 0
end
END
refuse 2 "gauges are on beams" << END
body b rigid
  gauge g 0 0 1
end
END
refuse 10 "no beam of body b has the name tip" << END
body b parts
  beam boom
    length 1
    modes bend_y 1
    stations x mass EI_y
      0 1 1
    end
    node tip tip
  end
  gauge g tip 0 0 1
end
END
refuse 3 "no such word for a beam: start_spin" << END
body b parts
  beam boom
    start_spin 0 0 1
  end
end
END
refuse 4 "beam boom of line 2 wants a line \`end\`" << END
body b parts
  beam boom
    length 1
  # the file ends here
END
refuse 6 "beam boom, its modes: " << END
body b parts
  hub 1  0 0 0  1 1 1
  effects linear
  beam boom
    length 1
    modes bend_y 1
    stations x mass EI_y
      0 1 1
    end
  end
end
END
refuse 2 "exact takes a straight beam" << END
exact 4
body b parts
  hub 1  0 0 0  1 1 1
  effects rigid
end
END
printf 'duration 1\nstep \000 0.1\n' > "$out/zero.txt"
status=0
"$out/careful" "$out/zero.txt" > "$out/log" 2>&1 || status=$?
[ $status = 2 ] && grep -q 'zero.txt:2: is no text' "$out/log" || fail "zeros in a file: status $status, $(cat "$out/log")"
refuse 8 "base of body b among others or on a joint: give it a joint to ground" << END
$top
duration 1
body b rigid
  hub 1  0 0 0  1 1 1
  base pinned
end
END
refuse 5 "base of body b among others or on a joint: give it a joint to ground" << END
$top
body b file ../../../examples/boom.txt
end
duration 1
END
refuse 8 "base of body b among others or on a joint: leave it out, its joint says how it is held" << END
$top
duration 1
body b rigid
  hub 1  0 0 0  1 1 1
  base pinned
end
joint j revolute ground b
end
END
refuse 5 "start_velocity under trim: the steady state has its own" << END
trim
body b rigid
  hub 1  0 0 0  1 1 1
  node 0 0 1 tip
  start_velocity 1 0 0
end
END
refuse 9 "the rate of a mode under trim" << END
$(echo "$beam" | sed 's/^end/  start_mode 2 0 1\nend/')
trim
END
refuse 6 "a speed under trim" << END
$top
joint j revolute ground top
  start 1 0 1
end
trim
END
refuse 8 "an event at 2 s: the duration is 1 s" << END
$top
joint j revolute ground top
end
event 1 lock j 1
event 2 free j 1
duration 1
END
# other LINE REASON < FILE: a joint of bodies top and b, and what follows it
other() {
  { echo "$top"; printf 'body b rigid\n  hub 1  0 0 0  1 1 1\nend\n'; cat; printf 'duration 1\n'; } > "$out/other.txt"
  refuse $(($1 + 7)) "$2" < "$out/other.txt"
}
other 1 "a free joint is one to ground" << END
joint j free top b
end
END
other 2 "position of a free joint: give its body start_position" << END
joint j free ground b
  position 1 0 0
end
END
other 2 "stiffness, number 4 of 6 is missing" << END
joint j free ground b
  stiffness 1 2 3
end
END
other 2 "friction of a joint that has no axis for it" << END
joint j free ground b
  friction 1 1 1 1 1 1
end
END
other 2 "rest of a joint wants a line stiffness" << END
joint j revolute ground b
  rest 0.3
end
END
other 2 "friction_speed of a joint wants a line friction" << END
joint j revolute ground b
  friction_speed 0.3
end
END
other 2 "length of a spring wants a line stiffness" << END
spring s ground b
  length 0.3
  pull constant 1
end
END
other 2 "a free joint has no motors: use load" << END
joint j free ground b
  motor 1 constant 1
end
END
other 2 "the spring of a spherical joint rests at zero" << END
joint j spherical top b
  rest 1
end
END
other 3 "a free joint closes no loop" << END
joint j revolute top b
end
loop k free top b
end
END
other 5 "a loop has no joint_acceleration" << END
joint j revolute top b
end
loop k revolute top b
end
output a joint_acceleration k 1
END
# chosen LINE REASON WORDS: a beam with these words, under auto
chosen() {
  refuse "$1" "$2" << END
$(echo "$beam" | sed "s/^end/  auto 0.1\n$3\nend/")
duration 1
END
}
chosen 9 "auto chooses the effects itself" "  effects spin"
chosen 10 "start_mode under auto" "  start_mode 1 0.1"
chosen 1 "body beam: no advice by auto: nothing that acts moves its last node" "  damping 0.1"
refuse 5 "auto wants modes to choose among" << END
body top rigid
  hub 1  0 0 0  1 2 3
  # a comment
  node 0 0 1 tip
  auto 0.1
end
duration 1
END
refuse 9 "auto wants a duration" << END
$(echo "$beam" | sed 's/^end/  auto 0.1\nend/')
trim
END
fails "at 0.5 s, step of 0.001 s: constraints contradict each other" 5 << END
$top
joint j revolute ground top
  motor 1 constant 1
  value 1 constant 3
  mode free
end
event 0.5 prescribe j 1
duration 1
END
# a load that hangs by a cable whose joint lets it turn about the cable
for joint in "axis 1:universal" "some axis:spherical"; do
  refuse 6 "no steady state: nothing holds ${joint%:*} of joint cable: lock it, or give it a spring" << END
gravity 0 0 -9.81
trim
body load rigid
  hub 50  0 0 -2  5 5 1
end
joint cable ${joint#*:} ground load
end
END
done
refuse 0 "steps of 4.77e-14 s for the fastest that acts" << END
$top
load top dead force 1 0 0 sine 1 1e12
duration 1
END
refuse 0 "output p: power is that of joints" << END
$top
output p power
duration 1
END
refuse 6 "factor is there twice" << END
$top
output x position top x
reference ../../../tests/reference/p10_symmetric_top.csv t w1 output x factor 2 factor 3 tolerance 1
END
refuse 5 "body top has no modes" << END
$top
output a mode top 1
END
refuse 1 "a title has 127 characters at most" << END
title $(printf '%0128d' 0)
END
refuse 0 "body b of line 2: more than 64 loads" << END
duration 1
body b exact
  length 1
  station 0
    stiffness 0 0 0 0 0 1
    mass 1
$(for k in $(seq 64); do echo 'load 1 dead 0 1 0'; done)
end
load b dead force 1 0 0
END
warned "a node at 0.5 is taken at 0.666667, the nearest node of 3 elements" 0 << END
trim
body b exact
  length 1
  elements 3
  station 0
    stiffness 0 0 0 1 1 1
    mass 1
  node 0.5 middle
  node tip tip
end
END
ball='duration 1
body b rigid
  hub 1  0 0 0  1 1 1
end'
refuse 5 "spring s connects the ground to itself" << END
$ball
spring s ground ground
end
END
refuse 6 "stiffness must not be negative" << END
$ball
spring s b ground
  stiffness -1
end
END
refuse 6 "no such word for a spring: rest" << END
$ball
spring s b ground
  rest 1
end
END
refuse 7 "length is there twice" << END
$ball
spring s b ground
  length 1
  length 2
end
END
refuse 5 "spring s of line 5 wants a line \`end\`" << END
$ball
spring s b ground
END
refuse 7 "two springs have the name s" << END
$ball
spring s b ground
end
spring s ground b
end
END
refuse 7 "no spring has the name r" << END
$ball
spring s b ground
end
output l length r
END
strip='body b beam
  length 1
  stations x mass EI_z
    0 1 1
  end
  modes bend_y 2
  base prescribed'
refuse 10 "distributed loads are on beams with \`effects large\`; an exact beam has \`line\` among its own words" << END
duration 1
$strip
end
distributed b dead force 0 1 0
END
refuse 11 "distributed loads want a step, and bodies without auto" << END
duration 1
$strip
  effects large
end
distributed b dead force 0 1 0 to 0 2 0 sine 1 2
END
refuse 12 "axes of a distributed load must be one of dead follower, is base" << END
step 0.01
duration 1
$strip
  effects large
end
distributed b base force 0 1 0
END
refuse 22 "distributed loads want a step, and bodies without auto" << END
step 0.01
duration 1
$strip
  effects large
end
body c beam
  length 1
  stations x mass EI_z
    0 1 1
  end
  modes bend_y 2
  base prescribed
  node 1 tip
  auto 0.01
end
distributed b dead force 0 1 0
END
refuse 257 "more than 64 bodies" << END
$(for k in $(seq 65); do echo "$top" | sed "s/ top / top$k /"; done)
END
# ---- controllers, from line 11 on
# control LINE REASON LINE..: refused
control() {
  line=$1 reason=$2
  shift 2
  {
    printf 'duration 1\ninterval 0.1\n%s\njoint j revolute ground top\nend\noutput w gyro top z\noutput x position top x\ncontrol c\n' "$top"
    printf '  %s\n' "$@"
    printf 'end\n'
  } > "$out/control.txt"
  refuse "$line" "$reason" < "$out/control.txt"
}
control 11 "controller c has no sample: its instants are at multiples of it" 'input w' 'output motor j 1'
control 11 "controller c has no input" 'sample 0.1' 'pid 1 0 0' 'output motor j 1'
control 11 "controller c has no block" 'sample 0.1' 'input w' 'output motor j 1'
control 11 "controller c has no output" 'sample 0.1' 'input w' 'pid 1 0 0'
control 11 "controller c: a delay of 7 s is more than 60 samples" 'sample 0.1' 'delay 7' 'input w' 'pid 1 0 0' 'output motor j 1'
control 12 "sample must be greater than 0" 'sample 0'
control 13 "sample is there twice" 'sample 1' 'sample 1'
control 12 "a sample of 1e-08 s is below 1e-6 of the interval of 0.1 s" 'sample 1e-8' 'input w' 'pid 1 0 0' 'output motor j 1'
control 12 "delay must not be negative" 'delay -1'
control 12 "no output has the name v" 'input v'
control 12 "no such word for a controller: pd" 'pd 1 2'
control 12 "sample must stand before the blocks" 'pid 1 2 3'
control 12 "too much on the line" 'input w 1 2'
control 12 "quantize must be greater than 0" 'input w 1 quantize 0'
control 13 "differential gain is missing" 'sample 0.1' 'pid 1 2'
control 13 "time constant must not be negative" 'sample 0.1' 'pid 1 2 3 -1'
control 13 "7 Hz is not below half the frequency of the samples, 5 Hz" 'sample 0.1' 'notch 7 0.1 0.7'
control 13 "frequency in Hz must be greater than 0" 'sample 0.1' 'lowpass 0 0.7'
control 13 "damping of the poles must be greater than 0" 'sample 0.1' 'notch 1 0 0'
control 13 "order must be a whole number from 1 to 6" 'sample 0.1' 'state_space 7'
control 13 "state_space is unstable: |z| = 1.1 of a pole; 1 at most" 'sample 0.1' 'state_space 1 1.1 1 1 0'
control 13 "D is missing" 'sample 0.1' 'state_space 1 0.5 1 1'
control 13 "saturate must be greater than 0" 'sample 0.1' 'saturate -1'
control 13 "a thruster goes off at 2, above 1 where it goes on" 'sample 0.1' 'thruster 5 1 2'
control 13 "shortest pulse must not be negative" 'sample 0.1' 'pulse 5 -0.1'
control 14 "nothing stands behind a thruster or pulse" 'sample 0.1' 'pulse 5' 'saturate 1'
control 12 "output of a controller must be one of motor pull load rotor allocation, is wheel" 'output wheel j 1'
control 12 "no joint has the name k" 'output motor k 1'
control 12 "no spring has the name s" 'output pull s'
control 13 "output is there twice" 'output motor j 1' 'output motor j 1'
control 12 "no output has the name u" 'input u'
control 12 "number of signals must be a whole number from 1 to 24" 'signals 25'
control 13 "signals stands before what comes in" 'input w' 'signals 2'
control 13 "gain, number 2 of 2 is missing" 'signals 2' 'input w 1'
control 13 "signal must be a whole number from 1 to 2" 'signals 2' 'reference 3 constant 1'
control 14 "reference 1 is there twice" 'signals 2' 'reference 1 constant 1' 'reference 1 constant 2'
control 16 "controller c makes 2 commands, its output takes 1" 'sample 0.1' 'signals 2' 'input w 1 1' 'pid 1 0 0' 'output motor j 1'
control 13 "rate_limit must be greater than 0" 'sample 0.1' 'rate_limit 0'
control 13 "dead_band must be greater than 0" 'sample 0.1' 'dead_band -1'
control 13 "value that goes out is missing" 'sample 0.1' 'table 0 0 1'
control 13 "the values of a table must ascend" 'sample 0.1' 'table 0 0 0 1'
control 15 "[A B; C D] has 1 rows of 2 numbers: of 1 signals that come in it wants 1 states, and a row for each and for each of 1 to 24 signals that go out" 'sample 0.1' 'state_space' '1 0' 'end' 'pid 1 0 0'
control 15 "this row of [A B; C D] has 1 numbers, the first one has 2" 'sample 0.1' 'state_space' '1 0' '1' 'end'
control 13 "$out/none.csv: No such file or directory" 'sample 0.1' 'state_space file none.csv'
control 12 "sample must stand before the shaper" 'shaper zv 1 0.1'
control 13 "a shaper must be one of zv zvd, is zvdd" 'sample 0.1' 'shaper zvdd 1 0.1'
control 13 "7 Hz is not below half the frequency of the samples, 5 Hz" 'sample 0.1' 'shaper zv 7 0.1'
control 13 "a mode of 1 Hz and the damping 1 does not swing: below 1" 'sample 0.1' 'shaper zv 1 1'
control 13 "more than 4 modes" 'sample 0.1' 'shaper zv 1 0 1 0 1 0 1 0 1 0'
control 13 "it shapes over more than 8191 samples: a faster mode, or a longer sample" 'sample 0.1' 'shaper zv 1e-9 0.1'
control 13 "it shapes over more than 8191 samples" 'sample 0.1' 'shaper zv 1e-300 0.1'
control 12 "sample must stand before attitude" 'attitude top'
control 14 "attitude stands before the other lines but sample and delay" 'sample 0.1' 'input w' 'attitude top'
control 14 "a controller of attitude has no input: it sees attitude and rate" 'sample 0.1' 'attitude top' 'input w'
control 12 "turn is that of attitude, whose line stands before" 'turn 0 0 1 constant 1'
control 12 "gyro is that of attitude, whose line stands before" 'gyro top'
control 12 "derivative is that of attitude, whose line stands before" 'derivative 3'
control 14 "the axis of a turn must not be zero" 'sample 0.1' 'attitude top' 'turn 0 0 0 constant 1'
control 14 "proportional wants 1 number, 3 of the axes or 9 of a matrix by rows, has 2" 'sample 0.1' 'attitude top' 'proportional 1 2'
control 11 "controller c of attitude has neither proportional nor derivative" 'sample 0.1' 'attitude top' 'pid 1 0 0' 'output motor j 1'
control 15 "controller c makes 3 commands, its output takes 1" 'sample 0.1' 'attitude top' 'proportional 1' 'output motor j 1'
control 12 "no allocation has the name a" 'output allocation a'
refuse 14 "margins: a gyro of another body than that of attitude has no linear model where it spins" << END
duration 1
body b rigid
  hub 1  0 0 0  1 1 1
  start_spin 0 0 1
end
body r rigid
  hub 1  0 0 0  1 1 1
end
joint k revolute b r
end
allocation a 3
  motor k 1 gains 0 0 1
end
control c
  sample 0.1
  attitude b
  gyro r
  proportional 1
  derivative 1
  saturate 1
  output allocation a
end
measure m pole_radius c
END
# allocations, from line 10 on
# allocation LINE REASON LINE..: refused
allocation() {
  line=$1 reason=$2
  shift 2
  {
    printf 'duration 1\ninterval 0.1\n%s\njoint j revolute ground top\nend\noutput w gyro top z\nallocation a 2\n' "$top"
    printf '  %s\n' "$@"
    printf 'end\n'
  } > "$out/control.txt"
  refuse "$line" "$reason" < "$out/control.txt"
}
allocation 11 "a line of an allocation begins with motor, pull, load or rotor, not with wheel" 'wheel j 1'
allocation 11 "expected gains, is missing" 'motor j 1'
allocation 11 "gain of a command, number 2 of 2 is missing" 'motor j 1 gains 1'
allocation 11 "a limit is a size, or from 0 or below to 0 or above: 1 to 2" 'motor j 1 gains 1 2 limit 1 2'
allocation 11 "a limit is a size, or from 0 or below to 0 or above: 3 to -3" 'motor j 1 gains 1 2 limit -3'
allocation 11 "no joint has the name k" 'motor k 1 gains 1 2'
allocation 13 "two allocations have the name a" 'motor j 1 gains 1 2' 'end' 'allocation a 1'
allocation 17 "command must be a whole number from 1 to 2" 'motor j 1 gains 1 2' 'end' 'control c' 'sample 0.1' 'input w' 'pid 1 0 0' 'output allocation a 3'
allocation 17 "controller c makes 1 commands, its output takes 2" 'motor j 1 gains 1 2' 'end' 'control c' 'sample 0.1' 'input w' 'pid 1 0 0' 'output allocation a'
allocation 13 "no allocation has the name b" 'motor j 1 gains 1 2' 'end' 'output f allocated b'
allocation 13 "actuator must be a whole number from 1 to 1" 'motor j 1 gains 1 2' 'end' 'output f allocated a 2'
allocation 10 "allocation a has no actuator"
loop="sample 0.1;input w;pid 1 0 0;output motor j 1;end"
IFS=';'
control 36 "more than 24 inputs" $(yes 'input w;' | head -n 25 | tr -d '\n')
control 19 "u is a command: an input is what a sensor sees" $loop 'output u command c' 'control d' 'input u'
control 17 "two controllers have the name c" $loop 'control c'
control 17 "no controller has the name d" $loop 'output u command d'
control 17 "no controller has the name d" $loop 'measure m phase_margin d'
unset IFS
refuse 7 "controller c of line 6 wants a line \`end\`" << END
duration 1
$top
control c
  sample 0.1
END
# what has no margins
no_margin() {
  line=$1 reason=$2
  shift 2
  {
    printf 'duration 1\ninterval 0.1\nstep 0.1\n%s\njoint j revolute ground top\nend\noutput w gyro top z\noutput x position top x\ncontrol c\n' "$top"
    printf '  %s\n' "$@"
    printf 'end\nmeasure m phase_margin c\n'
  } > "$out/control.txt"
  refuse "$line" "$reason" < "$out/control.txt"
}
no_margin 15 "margins: a thruster or pulse is not linear" 'sample 0.1' 'input w' 'thruster 1 1 0' 'output motor j 1'
no_margin 12 "margins: x has no linear model: take displacement" 'sample 0.1' 'input x' 'pid 1 0 0' 'output motor j 1'
no_margin 18 "margins: d has another sample than the controllers before it" 'sample 0.1' 'input w' 'pid 1 0 0' 'output motor j 1' end 'control d' \
  'sample 0.2' 'input w' 'pid 1 0 0' 'output load top base torque 0 0 1'
# rotors
refuse 6 "no such word for a rotor: spin" << END
$top
rotor w top
  spin 3
end
END
refuse 5 "rotor w wants an axis, not zero" << END
$top
rotor w top
  inertia 1
end
END
refuse 5 "rotor w wants an inertia" << END
$top
rotor w top
  axis 0 0 1
end
END
refuse 7 "inertia must be greater than 0" << END
$top
rotor w top
  axis 0 0 1
  inertia 0
end
END
refuse 7 "axis is there twice" << END
$top
rotor w top
  axis 0 0 1
  axis 0 0 1
end
END
refuse 7 "rotor w of line 5 wants a line \`end\`" << END
$top
rotor w top
  axis 0 0 1
  inertia 0.1
END
refuse 9 "two rotors have the name w" << END
$top
rotor w top
  axis 0 0 1
  inertia 0.1
end
rotor w top
  axis 0 0 1
  inertia 0.1
end
END
refuse 5 "body top has no node hub" << END
$top
rotor w top.hub
  axis 0 0 1
  inertia 0.1
end
END
refuse 1 "no body has the name top" << END
rotor w top
  axis 0 0 1
  inertia 0.1
end
$top
END
refuse 8 "motor of a rotor whose momentum is given" << END
$top
rotor w top
  axis 0 0 1
  inertia 0.1
  motor constant 1
  momentum constant 1
end
END
refuse 9 "friction of a rotor whose momentum is given" << END
$top
rotor w top
  axis 0 0 1
  inertia 0.1
  momentum constant 1
  friction 1 1
end
END
refuse 8 "a momentum must not jump: take ramp or smooth" << END
$top
rotor w top
  axis 0 0 1
  inertia 0.1
  momentum step 1 1
end
END
refuse 8 "damping must not be negative" << END
$top
rotor w top
  axis 0 0 1
  inertia 0.1
  damping -1
end
END
refuse 8 "speed of friction must be greater than 0" << END
$top
rotor w top
  axis 0 0 1
  inertia 0.1
  friction 1 0
end
END
refuse 9 "no rotor has the name x" << END
$top
rotor w top
  axis 0 0 1
  inertia 0.1
end
output s rotor_speed x
END
refuse 12 "no rotor has the name top.w" << END
$top
body more rigid
  hub 1  0 0 0  1 1 1
  rotor w
    axis 0 0 1
    inertia 0.1
  end
end
rotor top.w
  motor constant 1
end
END
refuse 14 "motor of a rotor whose momentum is given" << END
$top
body more rigid
  hub 1  0 0 0  1 1 1
  rotor w
    axis 0 0 1
    inertia 0.1
    momentum 0.2
  end
end
rotor more.w
  motor constant 1
end
END
refuse 13 "speed of a rotor whose momentum is given" << END
$top
body more rigid
  hub 1  0 0 0  1 1 1
  rotor w
    axis 0 0 1
    inertia 0.1
    speed 2
  end
end
rotor more.w
  momentum constant 1
end
END
refuse 13 "too much on the line: more" << END
$top
body more rigid
  hub 1  0 0 0  1 1 1
  rotor w
    axis 0 0 1
    inertia 0.1
    speed 2
  end
end
rotor more.w more
end
END
refuse 24 "more than 4 rotors of body more" << END
$top
body more rigid
  hub 1  0 0 0  1 1 1
end
$(for k in 1 2 3 4 5; do printf 'rotor r%s more\n  axis 0 0 1\n  inertia 0.1\nend\n' $k; done)
END
refuse 15 "the momentum of rotor w is given: no motor" << END
$top
rotor w top
  axis 0 0 1
  inertia 0.1
  momentum constant 1
end
output s spin top z
control c
  sample 1
  input s
  pid 1 0 0
  output rotor w
end
END

# sections of no material in SI units, with line, figure and the likely mistake; each beam once, and nothing of what is not given
# or in other units. doubted TEXT LENGTH COLUMNS VALUES [LINE OF THE SCENE]: of a beam; TEXT empty: it says nothing
doubted() {
  {
    printf '%s\nbody rod beam\n  length %s\n  stations x %s\n    0 %s\n  end\n  modes bend_y 1\n  base prescribed\n' "${5:-trim}" "$2" "$3" "$4"
    printf 'end\nduration 1e-6\nstep 1e-6\n'
  } > "$out/doubt.txt"
  if [ "$1" ]; then
    warned "warning: body rod: line 5: at x = 0 $1" 0 < "$out/doubt.txt"
    [ "$(wc -l < "$out/log")" = 1 ] || fail "more than one warning: $(cat "$out/log")"
  else
    "$out/careful" "$out/doubt.txt" --quiet > "$out/log" 2>&1 && [ ! -s "$out/log" ] || fail "expected nothing but: $(cat "$out/log")"
  fi
}
doubted "" 10 "mass EA EI_z GJ i_y" "1.2 31724000 14004 10000 0.01"
doubted "sqrt(EA/mass) = 1.63e+05 m/s, of no material (50 to 20,000): lengths in mm, mass in kg/mm" 10000 "mass EA EI_z" "1.2e-3 31724000 14004e6"
doubted "sqrt(EA/mass) = 5.14e+06 m/s, of no material .*: lengths in mm, mass in t/mm" 10000 "mass EA EI_z" "1.2e-6 31724000 14004e6"
doubted "sqrt(EA/mass) = 5.14 m/s, of no material .*: E in N/mm^2" 10 "mass EA EI_z" "1.2 31.724 0.014004"
doubted "sqrt(EI/EA) = 21 m, above a third of the length, 10 m: EI in N mm^2" 10 "mass EA EI_z" "1.2 31724000 14004e6"
doubted "sqrt(EI/EA) = 0.021 m, below 1e-6 of the length, 30000 m: lengths in mm" 30000 "mass EA EI_z" "1.2 31724000 14004"
doubted "GJ/EI = 7.14e+05, beyond 1e-3 to 1e3: GJ in N mm^2" 10 "mass EI_z GJ" "1.2 14004 1e10"
doubted "GJ/EI = 1e-06, beyond 1e-3 to 1e3: EI in N mm^2" 10 "mass EI_y EI_z GJ" "1.2 1e10 1e11 1e4"
doubted "sqrt(i/mass) = 9.13 m, above a third of the length, 10 m" 10 "mass EI_z i_y" "1.2 14004 100"
doubted "" 10 "mass EI_z" "1.2 14004e6"
doubted "" 10000 "mass EA EI_z" "1.2e-3 31724000 14004e6" "units mm N"
warned "warning: body pair: line 6: left: at x = 2 sqrt(EA/mass) = 1.63e+05 m/s.*; line 13: right: at x = 0 sqrt(EI/EA) = 3.46 m, above a third" 0 << END
body pair parts
  beam left
    length 10
    stations x mass EA EI_z
      0  1.2    31724000 14004
      2  1.2e-3 31724000 14004
      10 1.2e-3 31724000 14004
    end
    modes bend_y 1
  end
  beam right
    length 10
    taper rectangle 0 1e-3 12 10 1e-3 12 2  7e10 3e10 2700
    modes bend_y 1
  end
end
duration 1e-6
step 1e-6
END
warned "warning: body rod: line 4: at x = 0 sqrt(EA/mass) = 5.14 m/s, of no material .*: E in N/mm^2" 0 << END
body rod exact
  length 10
  elements 2
  station 0
    stiffness 31.724 0 0 0 0.014 0.014
    mass 1.2
end
duration 1e-3
step 1e-3
END
refuse 5 "trim does not find where body b rests on springs alone" << END
trim
body b rigid
  hub 2  0 0 0  1 1 1
end
spring s ground b
  position 0 0 3  0 0 0
  stiffness 50
  length 1
end
load b dead force 0 0 -20
output z position b z
END
