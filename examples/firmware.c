/* firmware - a rotor blade in flight code: the model comes from ROM (a header that `reduce` made), the code holds what
   a step needs and nothing that builds models. A tip load at rest, then at 12.1 rpm.
   Its check: at rest the tip moves as the closed form of its damped modes says, within 1e-4 of the peak.
   Exit: 0 well, 1 a step failed or the check did. */
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#include "blade_rom.h" /* static const fb_body blade, made from examples/blade.txt */
#include <stdio.h>

static fb_state state; /* all that changes: RAM */
static fb_rk4_work work;

/* One control period: a dead load at the tip, out of the rotor plane. Returns the tip's flap displacement [m]. */
static fb_status period(fb_real *tip, fb_real force, fb_real spin, fb_real dt)
{
  fb_input input = {0};
  fb_motion motion;
  fb_node_motion at;
  fb_status status;
  input.w[2] = spin;
  input.n_load = 1;
  input.load[0].node = 1;
  input.load[0].force[2] = force;
  status = fb_rk4_step(&blade, &state, &work, &input, &input, &input, dt);
  status = status ? status : fb_body_motion(&blade, &motion, &state, &input);
  status = status ? status : fb_body_node_motion(&blade, &at, &state, &motion, 1);
  *tip = at.displacement[2];
  return status;
}

/* Tip displacement at time t after the load came on: damped oscillators psi F/K (1 - exp(-zeta w t)(cos + ..)). */
static fb_real closed_form(fb_real force, fb_real t)
{
  fb_real sum = FB_R(0.0);
  for (int a = 0; a < blade.n; a++) {
    const fb_real psi = blade.node[1].psi[3 * a + 2], k = blade.K.diagonal[a], c = blade.C.diagonal[a];
    const fb_real decay = FB_R(0.5) * c, w = FB_SQRT(k - decay * decay);
    fb_real e = FB_R(1.0), left = decay * t; /* exp(-left) by halving: libm's exp is not needed for this */
    int halvings = 0;
    while (left > FB_R(1e-2)) {
      left *= FB_R(0.5);
      halvings++;
    }
    e -= left * (FB_R(1.0) - FB_R(0.5) * left * (FB_R(1.0) - left / FB_R(3.0)));
    while (halvings-- > 0) {
      e *= e;
    }
    sum += psi * psi * force / k * (FB_R(1.0) - e * (FB_COS(w * t) + decay / w * FB_SIN(w * t)));
  }
  return sum;
}

int main(void)
{
  const fb_real dt = FB_R(0.001), force = FB_R(1000.0), rotor = FB_R(1.2671);
  fb_real worst = FB_R(0.0), at_rest = FB_R(0.0), peak = FB_R(0.0), tip = FB_R(0.0);
  fb_status status = fb_state_init(&blade, &state);
  for (int k = 1; k <= 3000 && status == FB_OK; k++) {
    fb_real miss;
    status = period(&tip, force, FB_R(0.0), dt);
    miss = tip - closed_form(force, (fb_real)k * dt);
    worst = FB_FABS(miss) > worst ? FB_FABS(miss) : worst;
    at_rest = FB_FABS(tip) > at_rest ? FB_FABS(tip) : at_rest;
  }
  printf("at rest, 1 kN at the tip: peak %.4f m, off the closed form by %.2e of it\n", (double)at_rest,
         (double)(worst / at_rest));
  status = status ? status : fb_state_init(&blade, &state);
  if (status == FB_OK) {
    const fb_real v[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)}, w[3] = {FB_R(0.0), FB_R(0.0), rotor};
    status = fb_state_from_velocity(&blade, &state, v, w, NULL);
  }
  for (int k = 1; k <= 3000 && status == FB_OK; k++) {
    status = period(&tip, force, rotor, dt);
    peak = FB_FABS(tip) > peak ? FB_FABS(tip) : peak;
  }
  if (status != FB_OK) {
    printf("%s\n", fb_status_string(status));
    return 1;
  }
  printf("at 12.1 rpm: peak %.4f m, stiffened by the spin\n", (double)peak);
  printf("model %d bytes in ROM, state %d bytes, work %d bytes\n", (int)sizeof blade, (int)sizeof state,
         (int)sizeof work);
  return worst < FB_R(1e-4) * at_rest ? 0 : 1;
}
