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
refuse 1 "the name of a parameter has letters" << END
parameter 1a 1
END
refuse 1 "scheme must be one of rk4" << END
scheme euler
END
refuse 1 "a body must be one of beam" << END
body a plate
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
refuse 5 "internal_force is an output of exact beams" << END
$top
output a internal_force top x
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
refuse 0 "motion is that of a single body's base" << END
$top
joint j revolute ground top
end
motion rate 0 0 1
duration 1
END
refuse 0 "bodies on joints take the schemes rk4 and sdirk" << END
$top
joint j revolute ground top
end
scheme exponential
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
fails "body top of line 1: auto wants a node" << END
body top rigid
  hub 1  0 0 0  1 2 3
  auto 0.1
end
duration 1
END
fails "at 0 s, step of 0.5 s: the step is longer" << END
$beam
duration 10
interval 0.5
step 0.5
load beam.tip dead force 0 1 0
END
fails "steps of 1e-19 s are 1e+19 or more in 1 s" << END
$top
duration 1
interval 0.1
step 1e-19
END
fails "body b of line 2: a force on its origin, and the exact beam begins elsewhere" << END
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
# what is warned of, and counts as missed or not
warned "goes through 6.3 rad in a step" 0 << END
$top
load top dead force 1 0 0 sine 1 10
duration 1
step 0.1
END
warned "auto of body beam: estimated error .* MISSED" 1 << END
$(echo "$beam" | sed 's/^end/  auto 1e-9\nend/')
motion rate 0 0 1 smooth 0.5 0 1
duration 1
END
