# meets < FILE: small scenes whose answers are closed forms, beyond what examples/scenes/ shows. scene.sh includes it.

# a pulse and a sine between rows: impulse, and A/(m w) (t - sin(w t)/w)
meets << END
duration 2
interval 0.1
body b rigid
  hub 2  0 0 0  1 1 1
end
load b dead force 10 0 0 pulse 1 0.51 0.54
load b dead force 0 10 0 sine 1 10
output vx velocity b x
output y position b y
measure vx final vx
measure y final y
expect vx 0.15 tolerance 1e-12
expect y 0.1591549431 tolerance 1e-4 relative
END
# large deflection, integrator and step chosen: a free body keeps what it starts with
meets << END
duration 2
interval 0.5
body b beam
  start_position 1 2 3
  start_velocity 0.5 0 -1
  start_attitude z 90
  hub 10  0 0 0  1 1 1
  length 4
  stations x mass EI_y EI_z
    0 0.5 100 100
  end
  effects large
  modes bend_y 2
  node tip tip
end
output r position b
output a attitude b
measure x final r_x
measure y final r_y
measure z final r_z
expect x 1 tolerance 1e-12
expect y 3 tolerance 1e-12
expect z 1 tolerance 1e-12
END
# a step that is given, each integrator, and an exponential one, whose step is fixed: ends where the pulse, ramp and table bend
for integrator in rk4 midpoint sdirk exponential; do
  meets << END
duration 1
interval 0.5
step 0.25
integrator $integrator
body b rigid
  hub 1  0 0 0  1 1 1
end
load b dead force 1 0 0 pulse 10 0.11 0.12
load b dead force 0 1 0 ramp 1 0.3 0.31
load b dead force 0 0 1 table 0 0 0.613 0 0.617 5 0.621 0
output v velocity b
measure x final v_x
measure y final v_y
measure z final v_z
expect x 0.1 tolerance 1e-12
expect y 0.695 tolerance 1e-12
expect z 0.02 tolerance 1e-12
END
done
# the pull of a spring, and a distributed load, from 10 N/m at the root to 30 N/m at the tip: impulses of a pulse within a step
meets << END
duration 1
interval 0.5
step 0.25
body b rigid
  hub 1  0 0 0  1 1 1
end
spring s b ground
  position 0 0 0  100 0 0
  pull pulse 10 0.11 0.12
end
output v velocity b x
measure x final v
expect x 0.1 tolerance 1e-12
END
meets << END
duration 0.2
interval 0.1
step 0.1
integrator sdirk
body b beam
  length 2
  stations x mass EI_z
    0 1 100
  end
  hub 1  0 0 0  1 1 1
  modes bend_y 2
  effects large
end
distributed b dead force 0 0 10 to 0 0 30 pulse 1 0.11 0.12
output p momentum z
measure z final p
expect z 0.4 tolerance 1e-9
END
# events within a step
meets << END
duration 1
interval 0.1
step 0.05
body a rigid
  hub 1  0 0 0  1 1 1
end
joint j revolute ground a
  start 1 0 1
end
event 0.555 lock j 1
output q coordinate j 1
measure q final q
expect q 0.555 tolerance 1e-12
END

# joints that are stiff for the run of rigid bodies: the spring's deflection, or the damper's lag T/c (t - I/c)
# joint STIFFNESS DAMPING DURATION ANGLE METHOD
joint() {
  meets << END
duration $3
interval 0.1
method $5
body a rigid
  hub 5  0.5 0 0  0.01 0.5 0.5
end
joint j revolute ground a
  stiffness $1
  damping $2
  motor 1 step 10 0.1
end
output q coordinate j 1
measure q final q
expect q $4 tolerance 1e-4 relative
END
}
joint 1e5 200 1 1e-4 recursive
joint 1e5 250 1 1e-4 dense
joint 1e5 1000 1 1e-4 recursive
joint 1e6 2000 1 1e-5 recursive
joint 0 300 1 0.0298055556 recursive
joint 1e5 200 100 1e-4 recursive
[ ! -s "$out/log" ] || fail "a stiff joint is warned of: $(cat "$out/log")"
meets << END
duration 1
interval 0.1
body a rigid
  hub 5  0.5 0 0  0.01 0.5 0.5
end
joint f free ground a
end
loop j revolute ground a
  stiffness 1e5
  damping 200
  motor 1 step 10 0.1
end
output q coordinate j 1
measure q final q
expect q 1e-4 tolerance 1e-4 relative
END
grep -q "fits the start" "$out/log" || fail "nothing is said of a run of rigid bodies that diverges"

# a saddle: a physical pendulum upright, sqrt(m g l/I); a column beyond its Euler load of (pi/2)^2 EI/L^2, roots of
# w'''' + P w'' + growth^2 w = 0, clamped and free
meets << END
duration 0.01
interval 0.01
gravity 0 -9.81 0
body a rigid
  hub 5  0.5 0 0  0.01 0.5 0.5
end
joint j revolute ground a
  start 1 1.5707963267948966
end
output q coordinate j 1
measure one growth 1
measure two growth 2
expect one 3.743565908 tolerance 1e-6 relative
expect two 3.743565908 tolerance 1e-6 relative
END
meets << END
trim
body column exact
  length 1
  elements 20
  station 0
    stiffness 0 0 0 0 0 1
    mass 1
  node tip tip
end
load column.tip dead force -2.5 0 0
measure one growth 1
expect one 0.4213976070 tolerance 2e-3 relative
END

# the origin of a body whose beam begins elsewhere: at rest under a force, the same torque by modes and exactly
for exact in 0 20; do
  meets << END
trim
exact $exact
body b beam
  length 2
  stations x mass EA EI_y EI_z GJ i_z
    0 1 1e7 2e4 2e4 1e4 1e-3
  end
  position 0.5 0.2 0
  base prescribed
  modes bend_y 3
  node tip tip
end
load b.tip base force 0 10 0
output torque reaction_torque b z
output x position b x
measure torque final torque
measure x final x
expect torque -25 tolerance 1e-6 relative
expect x 0 tolerance 1e-9
END
done
# the hub in axes of the body, a lump in those of the beam, which is twisted: J w of the parts, about the origin
for exact in 0 20; do
  meets << END
duration 1e-3
interval 1e-3
exact $exact
body b beam
  length 2
  stations x mass EA EI_y EI_z GJ i_y i_z twist_deg
    0 1 1e7 2e5 2e5 1e5 1e-3 1e-3 30
    2 1 1e7 2e5 2e5 1e5 1e-3 1e-3 30
  end
  elements 10
  lump 5 2  0.1 0.2 0.3  1 2 2.5 0.1 0.2 0.3
  position 0.5 0.2 0.1
  attitude 0.7071067811865476 0 0.7071067811865476 0
  hub 3  0.1 0.2 -0.1  3 2 1.5 0.3 0.1 0.2
  modes bend_y 3 bend_z 3 torsion 2
  start_spin 0.3 0.2 1
end
output h angular_momentum
output p momentum
measure x max h_x
measure y max h_y
measure z max h_z
measure px max p_x
expect x 5.4716 tolerance 1e-5 relative
expect y 3.2557333333 tolerance 1e-5 relative
expect z 5.827 tolerance 1e-5 relative
expect px -2.62 tolerance 1e-5 relative
END
  # what holds the root holds the hub, too; gravity of the body, without one of the scene: (3 + 2 1) g, (3 0.1 + 2 1.5) g
  meets << END
trim
exact $exact
body b beam
  length 2
  stations x mass EA EI_y EI_z GJ i_z
    0 1 1e7 2e4 2e4 1e4 1e-3
  end
  position 0.5 0.2 0
  hub 3  0.1 0 0  1 1 1
  base prescribed
  modes bend_y 3
  effects full gravity
  gravity 0 -9.81 0
end
output force reaction_force b y
output torque reaction_torque b z
measure force final force
measure torque final torque
expect force 49.05 tolerance 1e-6 relative
expect torque 32.373 tolerance 1e-6 relative
END
done
# an IMU feels the gravity of its body, where the scene has none: at rest on a spring, g upwards
meets << END
trim
body b rigid
  hub 2  0 0 0  1 1 1
  effects rigid gravity
  gravity 0 -9.81 0
end
joint j prismatic ground b
  axis 0 1 0
  stiffness 100
end
output f specific_force b y
output q coordinate j 1
measure f final f
measure q final q
expect f 9.81 tolerance 1e-9
expect q -0.1962 tolerance 1e-9
END
# an IMU in free fall towards a center feels nothing: g = 1000/(100 - x)^2, x = t^2/20 (1 + t^2/6000)
meets << END
duration 1
step 0.01
body b rigid
  hub 2  0 0 0  1 1 1
  central_gravity 1000  -100 0 0
end
output f specific_force b x
output a acceleration b x
measure f final f
measure a final a
expect f 0 tolerance 1e-12
expect a -0.100100092 tolerance 1e-9
END
# a body whose name begins with `ground`: two equal wheels drive each other apart by a motor
meets << END
duration 1
interval 0.5
body ground_wheel rigid
  hub 1  0 0 0  1 1 1
end
body wheel rigid
  hub 1  0 0 0  1 1 1
end
joint j revolute ground_wheel wheel
  motor 1 constant 2
end
output one spin ground_wheel z
output other spin wheel z
measure one final one
measure other final other
expect one -2 tolerance 1e-12
expect other 2 tolerance 1e-12
END
# gravity of a body under `auto`: it falls to twice its static deflection, m g L^4/(8 EI)
meets << END
duration 1
interval 0.005
body b beam
  length 2
  stations x mass EA EI_z
    0 1 1e7 2e4
  end
  base prescribed
  modes bend_y 4
  effects full gravity
  gravity 0 -9.81 0
  auto 0.01
  node tip tip
end
output d displacement b.tip y
measure least min d
expect least -1.962e-3 tolerance 0.02 relative
END
# trim of bodies on joints that spin freely: about the mass center, a = 2/3 m before the root; stretch m w^2/EA (a L^2/2 + L^3/3)
meets << END
trim
body hub rigid
  hub 10  0 0 0  3 4 5
  node 1 0 0 rim
  start_spin 0 0 1
end
body arm beam
  length 2
  stations x mass EA EI_y EI_z
    0 1 1e6 2e3 2e3
  end
  modes bend_y 1 axial 5
  node tip tip
end
joint j rigid hub.rim arm
end
output w spin hub z
output stretch displacement arm.tip x
measure w final w
measure stretch final stretch
expect w 1 tolerance 1e-6
expect stretch 4e-6 tolerance 0.002 relative
END
# what prescribes a free joint, along axes of the body: m w x v, and what holds a load and a moment
meets << END
duration 1
interval 0.5
body a rigid
  hub 2  0 0 0  2 2 2
end
joint j free ground a
  rate 1 constant 3
  rate 6 constant 0.5
end
load a dead force 0 0 5
load a base torque 0.7 0 0
output x drive j 1
output y drive j 2
output z drive j 3
output roll drive j 4
measure x final x
measure y final y
measure z final z
measure roll final roll
expect x 0 tolerance 1e-9
expect y 3 tolerance 1e-9
expect z -5 tolerance 1e-9
expect roll -0.7 tolerance 1e-9
END
# a beam on a hinge turns by 1 rad, as a whole: no elastic rotation
for exact in 0 10; do
  meets << END
duration 0.5
interval 0.1
exact $exact
body b beam
  length 2
  stations x mass EA EI_z
    0 1 1e7 2e5
  end
  modes bend_y 3
  base hinged
  hub 1  0 0 0  1 1 1
  start_spin 0 0 2
  node tip tip
end
output turn rotation b.tip z
output attitude attitude b z
measure turn final turn
measure attitude final attitude
expect turn 0 tolerance 1e-6
expect attitude 0.479425539 tolerance 1e-5
END
done
# an axis that is handed over to a rate goes on from where it is; without one it stays there
meets << END
duration 1
interval 0.5
body a rigid
  hub 1  0 0 0  1 1 1
end
body b rigid
  hub 1  0 0 0  1 1 1
end
joint j revolute ground a
  start 1 0 1
  rate 1 constant 3
  mode free
end
joint k prismatic ground b
  start 1 0.1 1
end
event 0.3 prescribe j 1
event 0.4 prescribe k 1
output turn coordinate j 1
output slide coordinate k 1
measure turn final turn
measure slide final slide
expect turn 2.4 tolerance 1e-12
expect slide 0.5 tolerance 1e-12
END
# turn and spin of a body on a spherical joint are in axes of the body, whatever those of the joint; z 90 and then x 30
meets << END
duration 0.01
interval 0.01
body a rigid
  hub 2  0 0 0  2 2 2
  start_attitude x 30
  start_spin 0 0 1
end
joint j spherical ground a
  attitude z 90
  axis 1 0 0
end
output at attitude a
output w spin a
measure w max at_w
measure x max at_x
measure y max at_y
measure z min at_z
measure spin final w_z
expect w 0.6830127019 tolerance 0.005
expect x 0.1830127019 tolerance 0.005
expect y 0.1830127019 tolerance 0.005
expect z 0.6830127019 tolerance 0.005
expect spin 1 tolerance 1e-9
END
# what falls, and what is pushed along an axis of space: the step resolves its modes, however rare the rows. A beam on a hub
# of 1e6 kg that is pushed at a = 1 m/s^2: sum of c_k a m L^4/EI (1 - cos w_k t) by the first two modes of a cantilever
swings() { # WEIGHT
  meets << END
gravity 0 0 $1
duration 2.15
interval 2.15
body hub rigid
  hub 1e6  0 0 0  1e6 1e6 1e6
end
body b beam
  length 2
  elements 10
  stations x mass EI_y EI_z
    0 3 2000 1000
  end
  modes bend_y 2
  node tip tip
end
joint j rigid hub b
end
load hub dead force 0 1e6 0
output tip displacement b.tip y
measure tip final tip
expect tip -0.0119924202 tolerance 0.005 relative
END
}
swings 0
swings -9.81
# two bodies on a hinge that fall: seven rigid modes, zeros whatever the weight
meets << END
gravity 0 0 -9.81
duration 0.1
interval 0.1
body hub rigid
  hub 10  0 0 0  1 1 1
end
body b beam
  length 2
  elements 10
  stations x mass EI_y EI_z
    0 3 2000 1000
  end
  modes bend_y 2
end
joint j revolute hub b
end
measure seventh frequency 7
expect seventh 0 tolerance 1e-6
END
# ---- sampled controllers. Of a double integrator, in two samples at its place and at rest: u = m/T^2 (r - x) - 3/2 m/T v
for acts in 'motor j 1' 'load b dead force 1 0 0' 'pull s'; do
  meets << END
duration 2
interval 0.5
step 0.1
body b rigid
  hub 2  0 0 0  1 1 1
end
joint j prismatic ground b
  axis 1 0 0
end
spring s b ground
  position 0 0 0  9 0 0
  stiffness 0
  length 1
end
output x coordinate j 1
output v speed j 1
control c
  sample 0.5
  input x
  input v 0.75
  reference constant 1
  pid 8 0 0
  output $acts
end
output u command c
measure x final x
measure v final v
measure most max x
measure least min u
expect x 1 tolerance 1e-12
expect v 0 tolerance 1e-12
expect most 1 tolerance 1e-12
expect least -8 tolerance 1e-12
END
done
# pid with all its parts, filtered: the difference equations of a mass that it pushes, 200 samples
pid=$(awk 'BEGIN { T = 0.05; tau = 0.1; m = 2
  for (k = 0; k < 200; k++) {
    e = 1 - x
    s += T / 2 * (e + (k ? last : 0))
    d = (tau * d + e - (k ? last : e)) / (tau + T)
    last = e
    u = 3 * e + 0.5 * s + 4 * d
    x += T * v + T * T / 2 * u / m
    v += T * u / m
  }
  printf "%.15g", x }')
meets << END
duration 10
interval 1
step 0.05
body b rigid
  hub 2  0 0 0  1 1 1
end
output x position b x
control c
  sample 0.05
  input x
  reference constant 1
  pid 3 0.5 4 0.1
  output load b dead force 1 0 0
end
measure x final x
expect x $pid tolerance 1e-11
END
# what a controller commands that sees nothing: answers of its blocks to a reference, the last ones at 0.9 s and 5.9 s
# commands DURATION VALUE REFERENCE BLOCK..
commands() {
  duration=$1 value=$2 reference=$3
  shift 3
  {
    printf 'duration %s\ninterval 0.1\nstep 0.1\nbody b rigid\n  hub 1  0 0 0  1 1 1\nend\noutput y position b y\n' "$duration"
    printf 'control c\n  sample 0.1\n  input y\n  reference %s\n' "$reference"
    printf '  %s\n' "$@"
    printf '  output load b dead force 1 0 0\nend\noutput u command c\nmeasure u final u\nexpect u %s tolerance 1e-12\n' "$value"
  } > "$out/control.txt"
  meets < "$out/control.txt"
}
commands 1 0.998046875 'constant 1' 'state_space 1  0.5  0.5  1  0'     # 1 - 0.5^9
commands 1 3.5 'constant 1' 'state_space 2  0 -1  1 0  1 2  1 1  0.5' # a quarter of a turn in a sample: C B + D at the tenth
commands 1 0.25 'constant 0.37' 'quantize 0.25'
commands 1 -0.5 'constant -0.375' 'quantize 0.25'                       # halves away from zero
commands 6 -0.45 'table 0 1 4.95 1 4.96 -1' 'pid 0 1 0' 'saturate 0.5'  # the integral waits at 0.5: 0.45 at 5 s, then down
# a table [A B; C D] is the block of one signal; limits of rate, bands and tables in closed form, each at 0.9 s
commands 1 0.998046875 'constant 1' 'state_space' '  0.5 0.5' '  1 0' end
printf '0.5,0.5\n1,0\n' > "$out/table.csv"
commands 1 0.998046875 'constant 1' 'state_space file table.csv'
commands 1 2 'constant 7' 'rate_limit 2'                       # 10 samples of at most 0.2, and..
commands 1 -0.5 'constant -0.5' 'rate_limit 2'                   # ..no more than is asked for
commands 1 0.5 'constant 2' 'dead_band 1.5'
commands 1 -0.5 'constant -2' 'dead_band 1.5'
commands 1 0 'constant 1.5' 'dead_band 1.5'
commands 1 -2.5 'constant -0.75' 'table -1 -3 -0.5 -2 0 0 1 4'
commands 1 4 'constant 3' 'table -1 -3 -0.5 -2 0 0 1 4'          # constant beyond
printf 'in,out\n-1,-3\n-0.5,-2\n0,0\n1,4\n' > "$out/bent.csv"
commands 1 -2.5 'constant -0.75' 'table file bent.csv in out'
# two signals crossed by a table, two commands of a sum of two controllers to four actuators: one pair pushes one way alone,
# all are scaled by the one that is beyond its limit the most, 1.5 of 1 and 6 of 4
meets << END
duration 1
interval 0.1
step 0.1
body b rigid
  hub 1  0 0 0  1 1 1
end
output x position b
allocation push 2
  load b dead force 1 0 0 gains 1 0.5 limit 1
  load b dead force 0 1 0 gains 0 2 limit -0.5 4
  load b dead force 0 0 1 gains 1 0 limit 0 3
  load b dead force 0 0 -1 gains -1 0 limit 0 3
end
control c
  sample 0.1
  signals 2
  input x_x 0 0
  reference 1 constant 3
  reference 2 constant -4
  state_space
    0 1
    1 0
  end
  output allocation push
end
control d
  sample 0.1
  input x_y 0
  reference constant 1
  pid 1 0 0
  output allocation push 1
end
output u command c
output f allocated push
output second allocated push 2
measure u1 final u_1
measure u2 final u_2
measure f1 final f_1
measure f2 final f_2
measure f3 final f_3
measure f4 final f_4
measure f22 final second
measure x final x_x
measure z final x_z
expect u1 -4 tolerance 1e-12
expect u2 3 tolerance 1e-12
expect f1 -1 tolerance 1e-12
expect f2 4 tolerance 1e-12
expect f3 0 tolerance 0.5e-12
expect f4 2 tolerance 1e-12
expect f22 4 tolerance 1e-12
expect x -0.5 tolerance 1e-12
expect z -1 tolerance 1e-12
END
# two controllers of the same motor, rotor and spring add up: from rest 1 + 2 N (m) at each
meets << END
duration 1
interval 0.5
step 0.1
body b rigid
  hub 2  0 0 0  1 1 2
end
body c rigid
  hub 3  0 0 0  1 1 1
end
joint j prismatic ground b
  axis 1 0 0
end
joint k prismatic ground c
  axis 1 0 0
end
spring s c ground
  position 0 0 0  -9 0 0
  stiffness 0
  length 1
end
body w rigid
  hub 1  0 0 0  1 1 2
end
rotor r w
  axis 0 0 1
  inertia 0.5
end
output v speed j 1
output vk speed k 1
output spin rotor_speed r
$(for of in 'motor j 1' 'pull s' 'rotor r'; do for size in 1 2; do
  printf 'control %s%s\n  sample 0.1\n  input v 0\n  reference constant %s\n  pid 1 0 0\n  output %s\nend\n' "${of%% *}" $size $size "$of"
done; done)
measure v final v
measure vk final vk
measure spin final spin
expect v 1.5 tolerance 1e-12
expect vk -1 tolerance 1e-12
expect spin 7.5 tolerance 1e-12
END
# the integral of what an allocation limits waits, a sample later than behind saturate: its difference equation
waits=$(awk 'BEGIN { for (k = 0; k < 60; k++) {
    v = k < 50 ? 1 : -1
    w = x + 0.05 * v
    x += u * u > 0.25 && v * w > 0 ? 0 : 0.1 * v
    u = w
  }
  printf "%.15g", u }')
meets << END
duration 6
interval 0.1
step 0.1
body b rigid
  hub 1  0 0 0  1 1 1
end
output y position b y
allocation one 1
  load b dead force 1 0 0 gains 1 limit 0.5
end
control c
  sample 0.1
  input y
  reference table 0 1 4.95 1 4.96 -1
  pid 0 1 0
  output allocation one
end
output u command c
measure u final u
expect u $waits tolerance 1e-12
END
# attitude by quaternions with gains of 1, 3 and 9 numbers: a rigid body by SciPy
attitude() {
  values=$(sed -n "s/^attitude_$1,//p" tests/reference/p16_control.csv)
  {
    printf 'duration 12\ninterval 0.1\nstep 0.005\nbody b rigid\n  hub %s  0.2 -0.4 0.3\n' "${hub:-7  0 0 0  3 4 5}"
    printf '  start_attitude x 70 y -40 z 200\n  start_spin 0.1 -0.05 0.08\nend\n%b\nallocation torques 3\n' "$other"
    printf '  load b base torque 1 0 0 gains 1 0 0\n  load b base torque 0 1 0 gains 0 1 0\n  load b base torque 0 0 1 gains 0 0 1\nend\n'
    printf 'control c\n  sample 0.1\n  attitude b\n  reference z 50 x -30\n  turn 0 3 0 smooth 0.6 0 8\n'
    shift
    printf '  %s\n' "$@"
    printf '  output allocation torques\nend\noutput q attitude b\noutput w spin b\n'
    for of in q_w q_x q_y q_z w_x w_y w_z; do
      printf 'measure %s final %s\nexpect %s %s tolerance 1e-9\n' $of $of $of "${values%%,*}"
      values=${values#*,}
    done
  } > "$out/attitude.txt"
  meets < "$out/attitude.txt"
}
other=
attitude 1 'proportional 2' 'derivative 5'
attitude 3 'proportional 2 3 4' 'derivative 4 6 7' 'integral 0.1'
attitude 9 'proportional 2 0.3 -0.1  -0.2 3 0.4  0.1 -0.3 4' 'derivative 4 0.5 0.2  0.3 6 -0.4  -0.1 0.2 7'
# the same in two parts; the gyro is on the one that a rigid joint turns by a third of a turn
hub='6  0 0 0  2 3 4' other='body r rigid\n  hub 1  0 0 0  1 1 1\nend\njoint k rigid b r\n  attitude x 90 z 90\nend'
attitude 9 'gyro r' 'proportional 2 0.3 -0.1  -0.2 3 0.4  0.1 -0.3 4' 'derivative 4 0.5 0.2  0.3 6 -0.4  -0.1 0.2 7'
# its loops about that start, which spins, far from what is wanted; this stands or turns at 0.05 rad/s
# loops CASE RATE
loops() {
  IFS=, read -r difference phase_1 phase_2 phase_3 << END
$(sed -n "s/^loops_$1,//p" tests/reference/p16_control.csv)
END
  meets << END
duration 1
interval 0.1
step 0.01
body b rigid
  hub 7  0 0 0  3 4 5  0.2 -0.4 0.3
  start_attitude x 70 y -40 z 200
  start_spin 0.1 -0.05 0.08
end
allocation torques 3
  load b base torque 1 0 0 gains 1 0 0
  load b base torque 0 1 0 gains 0 1 0
  load b base torque 0 0 1 gains 0 0 1
end
control c
  sample 0.1
  delay 0.03
  attitude b
  reference z 50 x -30
  turn 0 3 0 ramp 10*$2 0 10
  proportional 2 0.3 -0.1  -0.2 3 0.4  0.1 -0.3 4
  derivative 4 0.5 0.2  0.3 6 -0.4  -0.1 0.2 7
  output allocation torques
end
measure difference return_difference c
measure phase_1 phase_margin c 1
measure phase_2 phase_margin c 2
measure phase_3 phase_margin c 3
expect difference $difference tolerance 1e-8
expect phase_1 $phase_1 tolerance 1e-8
expect phase_2 $phase_2 tolerance 1e-8
expect phase_3 $phase_3 tolerance 1e-8
END
}
loops still 0
loops turning 0.05
# a shaper leaves a mass on a spring at rest at its new place, the half period no whole number of samples; zvd where its frequency
# is wrong by 5 %, too, but for the square of that; of two modes both
# shaped SHAPER TOLERANCE: after 8 s
shaped() {
  meets << END
duration 8
interval 0.5
step 0.0025
body b rigid
  hub 1  0 0 0  1 1 1
end
body c rigid
  hub 1  0 0 0  1 1 1
end
joint j prismatic ground b
  axis 1 0 0
  stiffness 5.4045928
  damping 0.4649556
end
joint k prismatic ground c
  axis 1 0 0
  stiffness 39.4784176
  damping 0.2513274
end
allocation both 1
  motor j 1 gains 1
  motor k 1 gains 1
end
control c
  sample 0.05
  reference step 1 0.1
  shaper $1
  pid 1 0 0
  output allocation both
end
output x coordinate j 1
output v speed j 1
output y coordinate k 1
output w speed k 1
$2
END
}
# 0.37 Hz, zeta 0.1; 1 Hz, zeta 0.02
rest='measure x final x
measure v final v
expect x 0.185027752247312 tolerance 1e-7
expect v 0 tolerance 1e-7'
rest_too='measure y final y
measure w final w
expect y 0.025330295918 tolerance 1e-7
expect w 0 tolerance 1e-7'
shaped 'zv 0.37 0.1' "$rest"
shaped 'zvd 0.37 0.1' "$rest"
shaped 'zv 1 0.02' "$rest_too"
shaped 'zv 0.37 0.1 1 0.02' "$rest
$rest_too"
shaped 'zvd 1.05 0.02' 'measure most max w after 5
expect most 0 tolerance 4e-4'
shaped 'zv 1.05 0.02' 'measure most max w after 5
expect most 0.0055 tolerance 0.004'
# 32 thrusters at every second of 64 nodes are one force: the mass whose speed is held, below
{
  printf 'duration 0.1\ninterval 0.1\nstep 0.1\nbody b rigid\n  hub 2  0 0 0  1 1 1\n'
  for k in $(seq 64); do echo "  node 0 0 0.$k n$k"; done
  printf 'end\njoint j prismatic ground b\n  axis 1 0 0\nend\nallocation jets 1\n'
  for k in $(seq 32); do echo "  load b.$((2 * k)) base force 1 0 0 gains 0.03125"; done
  printf 'end\noutput v speed j 1\ncontrol c\n  sample 0.1\n  input v\n  pid 4 0 0\n  output allocation jets\nend\n'
  printf 'output jet allocated jets 32\nmeasure m gain_margin c\nexpect m 10 tolerance 1e-9 relative\n'
} > "$out/jets.txt"
meets < "$out/jets.txt"
# a filter at the frequency that it is exact at: nothing behind a notch, 1/(2 zeta) behind a low-pass filter, a quarter later
for filter in 'notch 1 0 0.7/0' 'notch 1 0.35 0.7/0.5' 'lowpass 1 0.7/0.714285714286'; do
  meets << END
duration 10
interval 0.01
step 0.01
body b rigid
  hub 1  0 0 0  1 1 1
end
output y position b y
control c
  sample 0.01
  input y
  reference sine 1 1
  ${filter%/*}
  output load b dead force 1 0 0
end
output u command c
measure u max u after 8
expect u ${filter#*/} tolerance 1e-10
END
done
# pushes DURATION SPEED REFERENCE LINE..: of 1 kg, by what acts and when
pushes() {
  duration=$1 value=$2 reference=$3
  shift 3
  {
    printf 'duration %s\ninterval 0.5\nstep 0.5\nbody b rigid\n  hub 1  0 0 0  1 1 1\nend\noutput y position b y\noutput v velocity b x\n' "$duration"
    printf 'control c\n  sample 0.1\n  input y\n  reference %s\n' "$reference"
    printf '  %s\n' "$@"
    printf '  output load b dead force 1 0 0\nend\nmeasure v final v\nexpect v %s tolerance 1e-12\n' "$value"
  } > "$out/control.txt"
  meets < "$out/control.txt"
}
pushes 1 1 'constant 1' 'pid 1 0 0'
pushes 1 0.75 'constant 1' 'delay 0.25' 'pid 1 0 0'
pushes 7 1 'constant 1' 'delay 6' 'pid 1 0 0'
pushes 1 0.45 'ramp 1 0 1' 'pid 1 0 0'                        # 0.1 (0 + 0.1 + .. + 0.9)
pushes 1.05 0.45 'ramp 1 0 1' 'delay 0.05' 'pid 1 0 0'
pushes 2 2.6 'table 0 0 1 1 2 0' 'thruster 2 0.45 0.25'       # on from 0.5 s to 1.8 s
pushes 2 -2.6 'table 0 0 1 -1 2 0' 'thruster 2 0.45 0.25'
pushes 2 2.4 'table 0 0 1 1 2 0' 'thruster 2 0.45 0.35'       # to 1.7 s
pushes 1 0.2 'pulse 1 0.25 0.35' 'thruster 2 0.5 0.1'         # one sample
pushes 1 0.6 'pulse 1 0.25 0.35' 'thruster 2 0.5 0.1 0.25'    # the shortest pulse, in whole samples
pushes 1 0.6 'pulse 1 0.25 0.35' 'thruster 2 0.5 0.1 0.3'
pushes 1 0.5 'constant 0.5' 'pulse 2'                         # a quarter of each sample
pushes 1 -0.5 'constant -0.5' 'pulse 2 0.02'
pushes 1 0 'constant 0.5' 'pulse 2 0.03'                      # which is below the shortest pulse
pushes 1 2 'constant 7' 'pulse 2 0.03'
pushes 1 0.5 'constant 0.5' 'delay 0.04' 'pulse 2'
# a sensor is rounded before its gain: 4 for 3.7; it sees what acted before, u' = 1 - u; two controllers, each at its own sample
meets << END
duration 1
interval 0.05
step 0.05
body b rigid
  hub 1  0 0 0  1 1 1
  start_velocity 0 3.7 0
end
output v velocity b y
output a specific_force b x
control first
  sample 0.05
  input v 0.5 quantize 1
  pid 1 0 0
  output load b dead force 0 0 1
end
control second
  sample 0.1
  input a
  reference constant 1
  pid 1 0 0
  output load b dead force 1 0 0
end
output u command first
output w velocity b
measure u min u
measure x final w_x
measure z final w_z
expect u -2 tolerance 1e-12
expect x 0.5 tolerance 1e-12
expect z -2 tolerance 1e-12
END
# ---- margins: a mass whose speed is held, L = a/(z - 1), a = K T/m: 2/a at z = -1, pi/2 - asin(a/2), that over its frequency.
# margin MEASURE VALUE LINE..: K = 4, T = 0.1 s, m = 2 kg
margin() {
  measure=$1 value=$2
  shift 2
  {
    printf 'duration 0.1\ninterval 0.1\nstep 0.1\nbody b rigid\n  hub 2  0 0 0  1 1 1\nend\njoint j prismatic ground b\n  axis 1 0 0\nend\n'
    printf 'output v speed j 1\noutput a specific_force b x\ncontrol c\n  sample 0.1\n'
    printf '  %s\n' "$@"
    printf '  output motor j 1\nend\nmeasure m %s c\nexpect m %s tolerance 1e-9 relative\n' "$measure" "$value"
  } > "$out/control.txt"
  meets < "$out/control.txt"
}
margin gain_margin 10 'input v' 'pid 4 0 0'
margin phase_margin 1.470628905633337 'input v' 'pid 4 0 0'
margin delay_margin 0.734085438449 'input v' 'pid 4 0 0'
margin gain_margin 5 'input v' 'pid 4 0 0' 'state_space 1  0.5  0.5  1  0' # |z| = 1 where 0.5 + 0.5 a g = 1
margin gain_margin 2 'input a' 'pid 1 0 0'                                 # it feels what acted before: L = K/(m z)
margin phase_margin 3.141592653589793 'input a' 'pid 1 0 0'
margin gain_margin 10 'input v' 'pid 4 0 0' 'saturate 1' 'quantize 0.1'    # while small
margin gain_margin 10 'input v' 'pid 4 0 0' 'rate_limit 1' 'dead_band 1'     # while it acts
margin gain_margin 10 'input v' 'pid 2 0 0' 'table -1 -3 0 0 1 2 2 3'          # by the slope at 0
margin return_difference 0.9 'input v' 'pid 4 0 0'                           # |1 - a/2| at z = -1
margin gain_margin 1 'input v' 'pid 41 0 0'                                # unstable
margin pole_radius 1.05 'input v' 'pid 41 0 0'
# the same by SciPy of a disk of 100 kg m^2, rate and angle fed back, for half a sample of delay
IFS=, read -r case gain reduction phase late radius << END
$(grep '^rigid,' tests/reference/p13_margins.csv)
END
meets << END
duration 0.1
interval 0.1
step 0.01
body b rigid
  hub 1  0 0 0  100 100 100
end
joint j revolute ground b
end
output angle coordinate j 1
output rate speed j 1
control c
  sample 0.01
  delay 0.005
  input angle
  input rate 3
  pid 40 0 0
  output motor j 1
end
measure gain gain_margin c
measure reduction gain_reduction c
measure phase phase_margin c
measure late delay_margin c
measure radius pole_radius c
expect gain $gain tolerance 1e-6 relative
expect reduction $reduction tolerance 1e-6
expect phase $phase tolerance 1e-6 relative
expect late $late tolerance 1e-6 relative
expect radius $radius tolerance 1e-6 relative
END

# rotors: a motor turns wheel and body against each other; a momentum that is given; trim with a motor against friction, beside one with an
# imbalance that does not turn
meets << END
duration 5
interval 0.1
body b rigid
  hub 10  0 0 0  1 3 2.5
end
rotor w b
  axis 0 2 0
  inertia 0.02
  motor constant 0.01
end
output wy spin b y
output s rotor_speed w
measure wy final wy
measure s final s
expect wy -0.01*5/3 tolerance 1e-9
expect s 2.5166666667 tolerance 1e-6
END
meets << END
duration 5
interval 0.1
body b rigid
  hub 10  0 0 0  1 3 2.5
end
rotor w b
  axis 0 1 0
  inertia 0.02
  momentum smooth 0.6 0 4
end
output wy spin b y
measure wy final wy
expect wy -0.6/3 tolerance 1e-12
END
meets << END
trim
duration 5
interval 0.1
body b rigid
  hub 10  0 0 0  1 3 2.5
  node 1 0 0 n
end
rotor w b.n
  axis 0 1 0
  inertia 0.02
  speed 40
  damping 2e-3
  friction 1e-3 0.2
  motor constant 0.08099998750023437
end
rotor idle b
  axis 1 0 0
  inertia 0.02
  dynamic_imbalance 1e-3 30
  static_imbalance 1e-3
end
output s rotor_speed w
output h rotor_momentum w
measure s final s
measure least min h
expect s 40 tolerance 1e-6
expect least 0.8 tolerance 1e-6
END
# and a wheel on a hinge, by the same controller: the run, and the margins of the loop
cat > "$out/wheel.txt" << END
duration 20
interval 0.1
step 0.01
body hub rigid
  hub 100  0 0 0  10 12 15
end
body wheel rigid
  hub 1  0 0 0  0.012 0.012 0.02
end
joint axle revolute hub wheel
  damping 1e-4
  friction 1e-3
  friction_speed 1
  start 1 0 50
end
output turn attitude hub z
output rate gyro hub z
output speed speed axle 1
control c
  sample 0.1
  delay 0.03
  input turn 2
  input rate 3
  input speed 0.001
  reference smooth 0.2 0 5
  pid -4 0 0
  output motor axle 1
end
measure phase phase_margin c
measure radius pole_radius c
measure last final speed
END
try "$out/careful" "$out/wheel.txt" --quiet --out "$out/wheel.csv"
try "$out/careful" "$out/wheel.txt"
meets << END
duration 20
interval 0.1
step 0.01
body hub rigid
  hub 101  0 0 0  10.012 12.012 15
end
rotor axle hub
  axis 0 0 1
  inertia 0.02
  damping 1e-4
  friction 1e-3 1
  speed 50
end
output turn attitude hub z
output rate gyro hub z
output speed rotor_speed axle
control c
  sample 0.1
  delay 0.03
  input turn 2
  input rate 3
  input speed 0.001
  reference smooth 0.2 0 5
  pid -4 0 0
  output rotor axle
end
measure phase phase_margin c
measure radius pole_radius c
measure last final speed
expect phase $(sed -n 's/^phase = //p' "$out/log") tolerance 1e-6
expect radius 1 tolerance 1e-6
reference wheel.csv t turn output turn tolerance 1e-7 relative
reference wheel.csv t rate output rate tolerance 1e-7 relative
reference wheel.csv t speed output speed tolerance 1e-7 relative
END
# the same in a scene of several bodies, one of them on a hinge with a rotor of its own
swings() {
  cat << END
duration 20
interval 0.1
step 0.01
body hub rigid
  hub $1
end
body arm rigid
  hub 2  1 0 0  0.1 0.8 0.8
end
joint hinge revolute hub arm
  position 0.5 0 0
  damping 0.1
  stiffness 2
end
rotor tip arm
  axis 0 0.3 1
  inertia 0.002
  speed -90
end
END
  cat
  cat << END
output turn attitude hub z
output tip rotor_speed tip
output angle coordinate hinge 1
control c
  sample 0.1
  delay 0.03
  input turn 2
  input rate 3
  input speed 0.001
  reference smooth 0.2 0 5
  pid -4 0 0
  output $2
end
measure phase phase_margin c
END
}
swings "100  0 0 0  10 12 15" "motor axle 1" > "$out/wheel.txt" << END
body wheel rigid
  hub 1  0 0 0  0.012 0.012 0.02
end
joint axle revolute hub wheel
  damping 1e-4
  friction 1e-3
  friction_speed 1
  start 1 0 50
end
output rate gyro hub z
output speed speed axle 1
END
try "$out/careful" "$out/wheel.txt" --quiet --out "$out/wheel.csv"
try "$out/careful" "$out/wheel.txt"
{
  swings "101  0 0 0  10.012 12.012 15" "rotor axle" << END
rotor axle hub
  axis 0 0 1
  inertia 0.02
  damping 1e-4
  friction 1e-3 1
  speed 50
end
output rate gyro hub z
output speed rotor_speed axle
END
  cat << END
expect phase $(sed -n 's/^phase = //p' "$out/log") tolerance 1e-6
reference wheel.csv t turn output turn tolerance 1e-7 relative
reference wheel.csv t angle output angle tolerance 1e-7 relative
reference wheel.csv t speed output speed tolerance 1e-7 relative
reference wheel.csv t tip output tip tolerance 1e-7 relative
END
} > "$out/rotor.txt"
meets < "$out/rotor.txt"
# a bare beam with clamped modes that swings from a hinge and bends far: no rigid body at its root with `effects large`. 6 modes: 2.4778
meets << END
duration 1
interval 0.01
gravity 0 0 -9.81
body rod beam
  length 1
  elements 8
  stations x mass EI_y EI_z
    0 1 0.2 0.2
  end
  modes bend_z 3
  effects large
end
joint hinge revolute ground rod
  axis 0 1 0
end
output angle coordinate hinge 1
output work energy
measure angle final angle
measure work final work_total
expect angle 2.4778 tolerance 1e-3
expect work 0 tolerance 5e-5
END

# a start in the third mode alone: the step that is chosen resolves it, though it is not the slowest: undamped, it still
# swings by as much at the end. w = 7.8548^2 sqrt(EI/(m L^4))
meets << 'END'
duration 60
interval 0.03
body b beam
  length 5
  stations x mass EI_z
    0 1 625
  end
  modes bend_y 3
  base prescribed
  start_mode 3 0.01
end
output third mode b 3
measure w frequency 3
measure early max third
measure late max third after 55
expect w 61.6972 tolerance 0.002 relative
expect early 0.01 tolerance 1e-9
expect late 0.01 tolerance 0.002 relative
END
