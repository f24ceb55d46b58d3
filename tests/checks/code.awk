# A random hub with one to three booms at random places and attitudes, together 1 to 12 modes: -v seed, -v effects, -v base.
function uniform(low, high) {
  state = (16807 * state) % 2147483647
  return low + (high - low) * state / 2147483647
}
function whole(low, high) {
  return low + int(uniform(0, 1) * (high - low + 1))
}
BEGIN {
  state = 1000 + 7919 * seed
  for (i = 0; i < 10; i++) uniform(0, 1)
  n = whole(1, 3)
  modes = 1 + (seed * 5) % 12
  if (n > modes) n = modes
  print "parts\nname generated\nbase " base "\neffects " effects
  if (effects ~ /damping/) print "damping " uniform(0.001, 0.05)
  if (effects ~ /gravity/) print "gravity " uniform(-0.5, 0.5) " " uniform(-0.5, 0.5) " " uniform(-0.5, 0.5)
  a = uniform(50, 200); b = uniform(50, 200)
  print "hub " uniform(50, 500) " " uniform(-0.3, 0.3) " " uniform(-0.3, 0.3) " " uniform(-0.3, 0.3) " " a " " b " " 0.9 * (a + b) " " uniform(-9, 9) " " uniform(-9, 9) " " uniform(-9, 9)
  print "node 0.1 0 0.2"
  for (k = 1; k <= n; k++) {
    own = k == n ? modes : 1 + int((modes - (n - k) - 1) * uniform(0, 1))
    modes -= own
    print "beam boom" k
    print "position " uniform(-1, 1) " " uniform(-1, 1) " " uniform(-1, 1)
    print "attitude x " uniform(0, 90) " z " uniform(0, 360) " y " uniform(-60, 60)
    print "length " uniform(4, 12) "\nelements 12"
    y = int((own + 1) * uniform(0, 1))
    t = own > 3 && uniform(0, 1) > 0.5
    if (y + t > own) t = 0
    line = "modes"
    if (y > 0) line = line " bend_y " y
    if (own - y - t > 0) line = line " bend_z " own - y - t
    if (t) line = line " torsion 1"
    print line
    print "stations x mass EA GJ EI_y EI_z i_y i_z"
    print "0 " uniform(0.5, 2) " 1e6 2000 " uniform(1000, 9000) " " uniform(1000, 9000) " 0.01 0.02"
    print "end\nnode tip\nend"
  }
}
