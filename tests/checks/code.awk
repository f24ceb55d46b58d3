# A random hub with one to three booms at random places and attitudes, together 1 to 12 modes: -v seed, -v effects, -v base.
# With effects large they are geometrically exact: curved, twisted, tapered, with offset masses, shear centers, lumped bodies, by
# seed, and there may be a component beside them. Factors, without which 1: -v stiffness, damping, mass (of all but the hub),
# hub_mass, hub_inertia. -v rotors: for each rotor the number of its node, and g if its momentum is given.
# -v central: mu of gravity of a center.
function uniform(low, high) {
  state = (16807 * state) % 2147483647
  return low + (high - low) * state / 2147483647
}
function whole(low, high) {
  return low + int(uniform(0, 1) * (high - low + 1))
}
function factor(x) {
  return x == "" ? 1 : x
}
BEGIN {
  CONVFMT = OFMT = "%.17g"
  K = factor(stiffness); m = factor(mass); J = factor(hub_inertia)
  state = 1000 + 7919 * seed
  for (i = 0; i < 10; i++) uniform(0, 1)
  n = whole(1, 3)
  modes = 1 + (seed * 5) % 12
  if (n > modes) n = modes
  print "parts\nname generated\nbase " base "\neffects " effects
  if (effects ~ /damping/) print "damping " factor(damping) * uniform(0.001, 0.05)
  if (effects ~ /gravity/) print "gravity " uniform(-0.5, 0.5) " " uniform(-0.5, 0.5) " " uniform(-0.5, 0.5)
  if (central) print "central_gravity " central " " uniform(-20, 20) " " uniform(90, 100) " " uniform(-20, 20)
  a = uniform(50, 200); b = uniform(50, 200)
  print "hub " factor(hub_mass) * uniform(50, 500) " " uniform(-0.3, 0.3) " " uniform(-0.3, 0.3) " " uniform(-0.3, 0.3) " " J * a " " J * b " " J * 0.9 * (a + b) " " J * uniform(-9, 9) " " J * uniform(-9, 9) " " J * uniform(-9, 9)
  print "node 0.1 0 0.2"
  for (k = 1; k <= n; k++) {
    own = k == n ? modes : 1 + int((modes - (n - k) - 1) * uniform(0, 1))
    modes -= own
    print "beam boom" k
    print "position " uniform(-1, 1) " " uniform(-1, 1) " " uniform(-1, 1)
    print "attitude x " uniform(0, 90) " z " uniform(0, 360) " y " uniform(-60, 60)
    large = effects ~ /large/
    L = uniform(4, 12)
    bent = large && n < 3 && (seed + k) % 4 == 0
    if (bent) for (j = 0; j <= 3; j++) print "point " L * j / 3 " " 0.02 * L * j * j / 9 " " 0.01 * L * j / 3
    if (!bent) print "length " L "\nelements 12"
    if (large && (seed + k) % 3 == 0) print "lump " (bent ? 3 : 12) " " uniform(1, 5) " 0.1 -0.05 0.1 0.1 0.2 0.15"
    y = int((own + 1) * uniform(0, 1))
    t = own > 3 && uniform(0, 1) > 0.5
    if (y + t > own) t = 0
    line = "modes"
    if (y > 0) line = line " bend_y " y
    if (own - y - t > 0) line = line " bend_z " own - y - t
    if (t) line = line " torsion 1"
    if (large && (n > 2 || seed % 5 == 0)) line = line " points " (n > 2 ? 8 : own + 4)
    print line
    if (large) {
      turn = seed % 2 ? 0 : uniform(5, 20)
      solid = (seed + k) % 3 == 1 || t ? uniform(0.01, 0.02) : 0
      aside = (seed + k) % 5 == 1 && solid ? uniform(0.01, 0.03) : 0
      print "stations fraction mass EA GJ EI_y EI_z GA_y GA_z i_y i_z twist_deg mass_y shear_z"
      print "0 2 " K * 1e6 " " K * 2000 " " K * uniform(2000, 9000) " " K * uniform(2000, 9000) " " K * 1e6 " " K * 1e6 " " solid " " solid " 0 " aside " " aside
      print "1 " uniform(1, 2) " " K * 1e6 " " K * 2000 " " K * uniform(1000, 2000) " " K * uniform(1000, 2000) " " K * 1e6 " " K * 1e6 " " solid " " solid " " turn " " aside " " aside
      print "end\nnode tip\n" (n < 3 ? "node " L / 3 "\n" : "") "end"
      continue
    }
    print "stations x mass EA GJ EI_y EI_z i_y i_z"
    print "0 " m * uniform(0.5, 2) " " K * 1e6 " " K * 2000 " " K * uniform(1000, 9000) " " K * uniform(1000, 9000) " " m * 0.01 " " m * 0.02
    print "end\nnode tip\nend"
  }
  if (large && seed % 4 == 3 && (seed * 5) % 12 < 10) {
    print "component panel\nmodes 2\nfrequency_hz " 0.3 * sqrt(K) " " 0.5 * sqrt(K) "\nposition 0 -0.5 0"
    for (j = 1; j <= 4; j++) print "node " j " 0 " (-j) " 0 2 0.1 0.1 0.1"
    for (j = 1; j <= 4; j++) print "shape 1 " j " 0 0 " j * j / 16 " " (-j / 8) " 0 0\nshape 2 " j " " j * j / 16 " 0 0 0 0 " j / 8
    print "line frame 0 0 0 1 2 3 4\nmark 4 edge\nend"
  }
  wheels = split(rotors, wheel, " ")
  for (k = 1; k <= wheels; k++) {
    print "rotor wheel" k " " wheel[k] + 0 "\naxis " uniform(-1, 1) " " uniform(-1, 1) " " uniform(-1, 1) "\ninertia " uniform(0.05, 0.1)
    print wheel[k] ~ /g/ ? "momentum 2" : "damping " uniform(0.001, 0.01) (k % 2 ? "\nfriction " uniform(0.01, 0.1) " 2" : "")
    print "end"
  }
}
