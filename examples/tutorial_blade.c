/* tutorial_blade - a rotor blade that rotates steadily: its frequencies over spin, then a gust on its tip.
   It shows: modes that converge under centrifugal tension, steady states, complex modes, the choice of a step.
   Check: frequencies of a uniform blade as published (Wright et al. 1982; tests/reference/p02_rotating_uniform.csv),
   and the blade comes to rest where the steady state under the gust says. Exit: 0 well, 1 a check failed. */
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#include <math.h>
#include <stdio.h>

static fb_body body;
static int tip;

/* A uniform blade along x on a hub that rotates about z: it flaps along z and lags along y. */
static fb_status make_blade(fb_real spin)
{
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_shape shape;
  static fb_body_work body_work;
  const fb_section uniform = {.mass = 10, .EI_y = 400000, .EI_z = 400000}; // [kg/m], [N m^2]; or a table of stations
  const fb_beam_desc blade = {.length = 10, .n_element = 16, .n_station = 1, .station = {uniform}};
  const fb_modes_desc keep = {.count = {4, 4}, .spin = spin}; // Ritz modes for every spin up to this one
  fb_body_desc level = {.base = FB_BASE_PRESCRIBED, .effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING};
  fb_status status = fb_beam_init(&beam, &blade);
  for (int k = 0; k < 8; k++) {
    level.zeta[k] = FB_R(0.02);
  }
  status = status ? status : fb_modes_solve(&modes, &modes_work, &beam, &keep);
  status = status ? status : fb_shape_init(&shape, modes.n);
  status = status ? status : fb_shape_add_beam(&shape, 0, &beam, &modes);
  status = status ? status : fb_shape_add_beam_node(&shape, &tip, 0, &beam, &modes, blade.length);
  return status ? status : fb_body_init(&body, &body_work, &shape, &level);
}

/* Frequency [rad/s] of the first flap mode about the steady state under the input. */
static fb_status first_flap(double *flap, fb_state *state, const fb_input *input)
{
  static fb_analyse_work work;
  static fb_spectrum spectrum;
  fb_status status = fb_body_trim(&body, state, &work, input);
  status = status ? status : fb_body_spectrum_solve(&body, &work, &spectrum, state, input);
  *flap = 0;
  for (int a = 0; a < 2 && status == FB_OK; a++) { // of the two slowest modes the flap mode is the faster one
    *flap = fmax(*flap, hypot((double)spectrum.re[a], (double)spectrum.im[a]));
  }
  return status;
}

static fb_status flap_of_tip(double *z, const fb_state *state, const fb_input *input)
{
  fb_motion motion;
  fb_node_motion node;
  fb_status status = fb_body_motion_eval(&body, &motion, state, input);
  status = status ? status : fb_body_node_motion_eval(&body, &node, state, &motion, tip);
  *z = status ? 0 : (double)node.displacement[2];
  return status;
}

int main(void)
{
  /* spin and first flap frequency in units of sqrt(EI/(m L^4)), here 2 rad/s */
  static const double published[][2] = {{0, 3.51602}, {3, 4.79728}, {6, 7.36037}, {12, 13.17015}};
  static fb_analyse_work work;
  fb_state state;
  fb_rk4_work rk4;
  fb_input input = {0};
  double z = 0, rest = 0, worst = 0;
  fb_real dt = 0;
  fb_status status = make_blade(24); // [rad/s]
  status = status ? status : fb_state_init(&body, &state);
  for (int k = 0; k < 4 && status == FB_OK; k++) { // a Campbell diagram is this loop
    double flap = 0;
    input.w[2] = (fb_real)(2 * published[k][0]);
    status = first_flap(&flap, &state, &input);
    worst = fmax(worst, fabs(flap / (2 * published[k][1]) - 1));
    printf("spin %4.1f rad/s: flap %7.4f rad/s, published %7.4f\n", (double)input.w[2], flap, 2 * published[k][1]);
  }
  input.n_load = 1; // the gust: a force on the tip, axes of the body, from now on
  input.load[0] = (fb_load){.node = tip, .axes = FB_AXES_BODY, .force = {0, 0, 2000}};
  dt = FB_R(0.5) * fb_rk4_limit(&body, input.w[2], 0); // the limit of stability; fb_spectrum_dt is for an accuracy
  for (int k = 0; k < (int)(30 / dt) && status == FB_OK; k++) {
    status = fb_rk4_step(&body, &state, &rk4, &input, &input, &input, dt);
  }
  status = status ? status : flap_of_tip(&z, &state, &input);
  status = status ? status : fb_body_trim(&body, &state, &work, &input);
  status = status ? status : flap_of_tip(&rest, &state, &input);
  if (status != FB_OK) {
    printf("%s\n", fb_status_string(status));
    return 1;
  }
  printf("gust: tip at %.5f m after 30 s in steps of %.2f ms, steady state %.5f m\n", z, 1000 * (double)dt, rest);
  if (!(worst < 1e-3 && fabs(z - rest) < 1e-3 * fabs(rest))) {
    printf("a check failed\n");
    return 1;
  }
  return fflush(stdout) == 0 ? 0 : 1;
}
