/* exact_count - 20 steps of a geometrically exact beam, for a counter of instructions (tests/checks/instructions.sh): a boom
   of 10 m and 10 elements that spins under gravity, let go from the bend that a tip load gives it. */
#include "check.h"
#include <string.h>

static fb_exact_desc desc;
static fb_exact beam;
static fb_exact_state state;
static fb_exact_work work;
static fb_exact_input input;

int main(void)
{
  static const fb_real stiffness[6] = {FB_R(1e5), FB_R(4e4), FB_R(4e4), 80, 100, 150}; /* [N], [N m^2] */
  static const fb_real inertia[6] = {1, 1, 1, FB_R(1e-3), FB_R(5e-4), FB_R(5e-4)};     /* [kg/m], [kg m] */
  desc.length = 10;                                                                    /* [m] */
  desc.n_element = 10;
  desc.n_station = 1;
  desc.gravity[2] = FB_R(-1.0); /* [m/s^2] */
  for (int i = 0; i < 6; i++) {
    desc.station[0].stiffness[7 * i] = stiffness[i];
    desc.station[0].inertia[7 * i] = inertia[i];
  }
  input.n_load = 1;
  input.load[0].node = 10;
  input.load[0].force[1] = 3; /* [N] */
  input.w[2] = FB_R(0.2);     /* [rad/s] */
  fbb_check(fb_exact_init(&beam, &desc), "beam");
  fbb_check(fb_exact_state_init(&beam, &state, &work, &input), "state");
  fbb_check(fb_exact_trim(&beam, &state, &work, &input), "steady state");
  input.n_load = 0;
  for (int i = 0; i < 20; i++) {
    fbb_check(fb_exact_step(&beam, &state, &work, &input, FB_R(0.002)), "step");
  }
  return 0;
}
