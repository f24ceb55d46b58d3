/* >>system: bodies whose beams are lines (FB_EFFECT_LARGE_DEFLECTION) on joints: by every method, Hamilton's equations by
   differences, against single bodies and against the same beams cut finer. */
#include "system.h"

#if FB_WITH_LARGE_DEFLECTION
static const double stencil[5] = {1.0 / 12, -2.0 / 3, 0, 2.0 / 3, -1.0 / 12}; /* derivative of fourth order */
static fb_system_state rate, kept;

/* The tree of every kind of joint, its beams bent by some 20 % of their length. */
static void bent_tree(int damped)
{
  tree(FB_EFFECTS_LARGE, damped);
  for (int k = 0; k < desc.n_body; k++) {
    for (int a = 0; a < model[desc.model[k]].n; a++) {
      start[k].q[a] *= FB_R(5.0);
      start[k].q_dot[a] *= FB_R(5.0);
    }
  }
}

/* E9.4, E9.6, E9.8 with M(q), Lambda(q), M_rr(q) of E14.12, E9.25 by the rows: motors, loads, axes that are locked and
   prescribed, by elimination, one dense matrix and multipliers; accelerations and reactions, then along a run. */
TEST(lines_move_alike_by_the_three_methods)
{
  static fb_system_motion first, recursive;
  double energy = 0.0;
  for (int method = 0; method < 3; method++) {
    bent_tree(1);
    drives();
    init((fb_method)method);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    if (method == 0) {
      first = motion;
      energy = energy_of(&state);
    }
    FBT_BELOW(motion_difference(&motion, &first), FBT_TOL(1e-10, 1e-2));
    FBT_NEAR_REL(energy_of(&state), energy, FBT_TOL(1e-12, 1e-5));
    stepped(&state, FB_SINGLE ? 20 : 200, FB_SINGLE ? 2e-3 : 2e-4);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    if (method == 0) {
      recursive = motion;
    }
    FBT_BELOW(motion_difference(&motion, &recursive), FBT_TOL(1e-9, 2e-2));
  }
}

/* E9.25, E9.15, E14.13: along the rates the energy does not change and the momenta stay, by differences; a joint on a
   line whose Jacobian's rate were wrong would do work. */
TEST(rates_of_systems_with_lines_are_those_of_hamilton)
{
  for (int method = 0; method < 3; method++) {
    const double h = FBT_TOL(3e-5, 1e-2);
    double slope = 0.0;
    fb_momentum at, before;
    bent_tree(0);
    init((fb_method)method);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    memset(&rate, 0, sizeof rate);
    FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, &input), FB_OK);
    FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &before, &state, &input), FB_OK);
    for (int side = -2; side <= 2; side++) {
      moved(&kept, &state, &rate, side * h);
      slope += stencil[side + 2] / h * energy_of(&kept);
      FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &at, &kept, &input), FB_OK);
      if (method < 2) {
        FBT_BELOW(fbt_difference(at.linear, before.linear, 3), FBT_TOL(1e-12, 1e-3));
      }
    }
    FBT_NEAR_ABS(slope, 0.0, FBT_TOL(1e-7, 1.0)); /* the rounding of the energy by h */
  }
}

/* E9.19, E14.16 in a system: accelerations of bodies, modes and joints are the rates of the velocities along the
   rates. */
TEST(accelerations_of_systems_with_lines_are_rates)
{
  static fb_system_motion at, side;
  const double h = FBT_TOL(1e-4, 1e-2);
  fb_real v_dot[FB_MAX_BODIES][3];
  double worst = 0.0;
  bent_tree(1);
  drives();
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, &input), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &at, &state, &input), FB_OK);
  for (int k = 0; k < desc.n_body; k++) {
    memcpy(v_dot[k], fbt_v_dot(&at.motion[k]), sizeof v_dot[k]);
  }
  for (int s = -2; s <= 2; s++) {
    fb_system_input moving = input;
    for (int k = 1; k < 3; k++) {
      moving.drive[k].rate[k - 1] += (fb_real)(s * h) * moving.drive[k].acceleration[k - 1];
    }
    moved(&kept, &state, &rate, s * h);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &side, &kept, &moving), FB_OK);
    for (int k = 0; k < desc.n_body; k++) {
      for (int i = 0; i < 3; i++) {
        v_dot[k][i] -= (fb_real)(stencil[s + 2] / h) * side.motion[k].v[i];
        at.motion[k].w_dot[i] -= (fb_real)(stencil[s + 2] / h) * side.motion[k].w[i];
        at.joint[k].acceleration[i] -= (fb_real)(stencil[s + 2] / h) * side.joint[k].speed[i];
      }
      for (int a = 0; a < model[desc.model[k]].n; a++) {
        at.motion[k].q_ddot[a] -= (fb_real)(stencil[s + 2] / h) * side.motion[k].q_dot[a];
      }
    }
  }
  for (int k = 0; k < desc.n_body; k++) {
    worst = fmax(worst, fmax(fbt_largest(v_dot[k], 3), fbt_largest(at.motion[k].w_dot, 3)));
    worst = fmax(worst, fbt_largest(at.motion[k].q_ddot, model[desc.model[k]].n));
    worst = fmax(worst, fbt_largest(at.joint[k].acceleration, 3));
  }
  FBT_BELOW(worst, FBT_TOL(1e-7, 1.0));
}

SUITE(system_lines, RUN(lines_move_alike_by_the_three_methods), RUN(rates_of_systems_with_lines_are_those_of_hamilton),
      RUN(accelerations_of_systems_with_lines_are_rates))
#endif
