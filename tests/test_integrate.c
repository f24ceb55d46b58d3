/* Section 11: rk4, its stability limit, conservation over long runs, the spin-up. */
#include "fbt.h"

static fb_beam_desc beam_desc;
static fb_beam beam;
static fb_modes modes;
static fb_modes_work modes_work;
static fb_shape shape;
static fb_body body;
static fb_body_work body_work;
static fb_body_desc body_desc;

/* A uniform boom (10 m, 12 kg) along x on a rigid hub with bend_y + bend_z + axial modes; its tip is node 1. */
static void boom(unsigned effects, fb_base base, int bend_y, int bend_z, int axial, double zeta)
{
  static const fb_real center[3] = {0},
                       inertia[6] = {FB_R(40.0), FB_R(30.0), FB_R(50.0), FB_R(2.0), -FB_R(1.0), FB_R(3.0)};
  fb_modes_desc keep;
  int tip;
  memset(&beam_desc, 0, sizeof beam_desc);
  beam_desc.length = FB_R(10.0);
  beam_desc.n_element = 10;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = FB_R(1.2);
  beam_desc.station[0].EA = FB_R(31724000.0);
  beam_desc.station[0].EI_y = beam_desc.station[0].EI_z = FB_R(14004.0);
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Y] = bend_y;
  keep.count[FB_KIND_BEND_Z] = bend_z;
  keep.count[FB_KIND_AXIAL] = axial;
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(20.0), center, inertia), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &tip, 0, &beam, &modes, FB_R(10.0)), FB_OK);
  memset(&body_desc, 0, sizeof body_desc);
  body_desc.effects = effects;
  body_desc.base = base;
  body_desc.allow_split_effects = 1;
  for (int k = 0; k < modes.n; k++) {
    body_desc.zeta[k] = (fb_real)zeta;
  }
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &body_desc), FB_OK);
}

static void start(fb_state *state, double deflection, double spin)
{
  fb_real v[3], w[3], qd[FB_MAX_MODES] = {0};
  FBT_INT_EQ(fb_state_init(&body, state), FB_OK);
  fbt_fill(state->q, body.n, deflection);
  fbt_fill(v, 3, 0.3);
  fbt_fill(w, 3, spin);
  FBT_INT_EQ(fb_state_from_velocity(&body, state, v, w, qd), FB_OK);
}

static double energy_of(const fb_state *state)
{
  fb_energy e;
  FBT_INT_EQ(fb_body_energy(&body, &e, state, NULL), FB_OK);
  return (double)e.kinetic + (double)e.strain + (double)e.gravity;
}

/* The load and the motion of the base at time t. */
static void drive(fb_input *input, double t)
{
  memset(input, 0, sizeof *input);
  input->n_load = 1;
  input->load[0].node = 1;
  input->load[0].axes = FB_AXES_NODE;
  input->load[0].force[1] = (fb_real)(20.0 * sin(3.0 * t));
  input->load[0].force[2] = (fb_real)(15.0 * cos(2.0 * t));
  input->v[0] = (fb_real)(0.4 * sin(t));
  input->w[2] = (fb_real)(0.5 * sin(2.0 * t));
  input->w[0] = (fb_real)(0.3 * t);
}

static void integrate(fb_state *state, double t_end, int steps)
{
  const double dt = t_end / steps;
  fb_rk4_work work;
  fb_input input[3];
  for (int k = 0; k < steps; k++) {
    for (int i = 0; i < 3; i++) {
      drive(&input[i], dt * (k + 0.5 * i));
    }
    FBT_INT_EQ(fb_rk4_step(&body, state, &work, &input[0], &input[1], &input[2], (fb_real)dt), FB_OK);
  }
}

/* E11.3: halving the step divides the error by 16, with loads and base motion that vary within the step. */
TEST(rk4_converges_with_order_four)
{
  for (int base = 0; base < 2; base++) {
    fb_state state[3];
    double error[2];
    boom(FB_EFFECTS_FULL, base ? FB_BASE_PRESCRIBED : FB_BASE_FREE, 2, 2, 0, 0.0);
    for (int k = 0; k < 3; k++) {
      fbt_seed(5);
      start(&state[k], 0.2, 0.3);
      integrate(&state[k], 2.0, k == 2 ? FBT_TOL(6400, 3200) : FBT_TOL(400, 80) << k);
    }
    for (int k = 0; k < 2; k++) {
      error[k] = fmax(fbt_difference(state[k].q, state[2].q, body.n), fbt_difference(state[k].quat, state[2].quat, 4));
    }
    if (FB_SINGLE) {
      FBT_BELOW(error[1], 3e-3); /* rounding hides the order */
    } else {
      fbt_figure(base ? "order of rk4, prescribed base" : "order of rk4, free base", "4", log2(error[0] / error[1]));
      FBT_NEAR_ABS(log2(error[0] / error[1]), 4.0, 0.3);
    }
  }
}

/* E8.18: unloaded and undamped, tumbling: linear and angular momentum to rounding over 1e6 steps with a coarse step; the
   drift of energy falls with at least the 4th power of the step. */
TEST(tumbling_conserves_momentum_and_energy)
{
  fb_state state;
  fb_rk4_work work;
  fb_momentum before, after;
  double drift[2];
  boom(FB_EFFECTS_FULL, FB_BASE_FREE, 1, 1, 0, 0.0);
  start(&state, 0.3, 0.5);
  FBT_INT_EQ(fb_body_momentum(&body, &before, &state, NULL), FB_OK);
  for (int k = 0; k < FBT_TOL(1000000, 20000); k++) { /* single: O drifts away, rho x P rounds */
    if (fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, FB_R(0.01)) != FB_OK) {
      FBT_FAIL("every step is ok");
      break;
    }
  }
  FBT_INT_EQ(fb_body_momentum(&body, &after, &state, NULL), FB_OK);
  fbt_figure(FBT_TOL(1, 0) ? "tumbling, 1e6 steps, linear momentum" : "tumbling, 2e4 steps, linear momentum",
             "conservation", fbt_difference(before.linear, after.linear, 3) / fbt_largest(before.linear, 3));
  fbt_figure(FBT_TOL(1, 0) ? "tumbling, 1e6 steps, angular momentum" : "tumbling, 2e4 steps, angular momentum",
             "conservation", fbt_difference(before.angular, after.angular, 3) / fbt_largest(before.angular, 3));
  FBT_BELOW(fbt_difference(before.linear, after.linear, 3), FBT_TOL(1e-9, 1e-3) * fbt_largest(before.linear, 3));
  FBT_BELOW(fbt_difference(before.angular, after.angular, 3), FBT_TOL(1e-9, 1e-3) * fbt_largest(before.angular, 3));
  for (int k = 0; k < 2; k++) {
    fbt_seed(1);
    start(&state, 0.3, 0.5);
    drift[k] = energy_of(&state);
    for (int i = 0; i < (2000 << k); i++) {
      FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, FB_R(0.04) / (fb_real)(1 << k)), FB_OK);
    }
    drift[k] = fabs(energy_of(&state) / drift[k] - 1.0);
  }
  FBT_BELOW(drift[1], FBT_TOL(1e-4, 1e-4));
  if (!FB_SINGLE) {
    FBT_TRUE(drift[0] / drift[1] > 16.0);
  }
}

/* Largest deflection in the last quarter of many steps over that in the first; huge if a step failed. The body spins about
   axis x or z of its frame, its mass center at rest. */
static double growth(double dt, double spin, int axis, int steps)
{
  fb_state state;
  fb_rk4_work work;
  fb_input input;
  double first = 0.0, last = 0.0;
  memset(&input, 0, sizeof input);
  input.w[axis] = (fb_real)spin;
  if (body.base == FB_BASE_FREE) {
    fb_vec3_cross(input.v, body.c, input.w);
    for (int i = 0; i < 3; i++) {
      input.v[i] /= body.mass;
    }
  }
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  fbt_fill(state.q, body.n, 1e-3);
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, input.v, input.w, NULL), FB_OK);
  for (int k = 0; k < steps; k++) {
    if (fb_rk4_step(&body, &state, &work, &input, &input, &input, (fb_real)dt) != FB_OK) {
      return HUGE_VAL;
    }
    if (k < steps / 4) {
      first = fmax(first, fbt_largest(state.q, body.n));
    } else if (k >= 3 * steps / 4) {
      last = fmax(last, fbt_largest(state.q, body.n));
    }
  }
  return last / first;
}

/* E8.8, E11.1: at the limit the motion stays bounded, 3 % beyond it leaves the range, for a free and a held root (the free
   boom is stiffer: rigid-elastic coupling). With spin up to five times the first bending frequency (3.8 rad/s), about the
   boom and across it, and with damping the limit is on the safe side. */
TEST(the_step_limit_is_the_stability_boundary)
{
  double limit[2];
  for (int base = 0; base < 2; base++) {
    fb_state state, same;
    fb_rk4_work work;
    boom(FB_EFFECTS_FULL, base ? FB_BASE_PRESCRIBED : FB_BASE_FREE, 3, 3, 1, 0.0);
    limit[base] = (double)fb_rk4_limit(&body, 0, 0);
    start(&state, 1e-3, 0.0);
    same = state;
    FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, (fb_real)(1.01 * limit[base])), FB_ERR_STEP);
    FBT_TRUE(memcmp(&same, &state, sizeof state) == 0);
    FBT_BELOW(growth(0.999 * limit[base], 0.0, 2, 4000), 1.01);
    body_desc.allow_long_step = 1;
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &body_desc), FB_OK);
    FBT_TRUE(growth(1.03 * limit[base], 0.0, 2, 4000) > 1e3);
  }
  FBT_TRUE(limit[0] < 0.95 * limit[1]);
  for (int k = 0; k < 12; k++) {
    const double spin = 4.0 * (k % 6), zeta = k % 2 ? 0.3 : 0.0;
    const int axis = k < 6 ? 2 : 0; /* whirl with damping in the turning frame is unstable by itself: undamped there */
    boom(FB_EFFECTS_FULL | FB_EFFECT_DAMPING, axis ? FB_BASE_FREE : FB_BASE_PRESCRIBED, 3, 3, k % 3 == 0,
         axis ? zeta : 0.0);
    body_desc.allow_long_step = 1; /* the elastic motion makes the spin exceed the nominal one a little */
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &body_desc), FB_OK);
    FBT_BELOW(growth(0.999 * (double)fb_rk4_limit(&body, (fb_real)spin, 0), spin, axis, 8000), 1.5);
  }
}

/* E11.1: a spinning free body whose origin is far from its mass center: what its own spin does to O counts. */
TEST(the_step_limit_knows_the_acceleration_of_a_far_origin)
{
  static const fb_real heavy[6] = {FB_R(4e4), FB_R(4e4), FB_R(4e4), 0, 0, 0};
  const fb_real root[3] = {-FB_R(10.0), 0, 0};
  double dt;
  boom(FB_EFFECTS_FULL, FB_BASE_FREE, 3, 3, 0, 0.0);
  beam_desc.position[0] = -FB_R(10.0);
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(1e4), root, heavy), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &body_desc), FB_OK);
  dt = (double)fb_rk4_limit(&body, FB_R(20.0), FB_R(4000.0));
  FBT_BELOW(dt, 0.8 * (double)fb_rk4_limit(&body, FB_R(20.0), 0));
  FBT_BELOW(growth(0.9 * dt, 20.0, 2, 8000), 1.5);
  FBT_TRUE(growth(0.97 * (double)fb_rk4_limit(&body, FB_R(20.0), 0), 20.0, 2, 8000) > 1e3); /* refused */
}

/* E11.2: a damped motion decays to exact zeros; no number on the way is subnormal. */
TEST(decay_reaches_zero_without_subnormals)
{
  fb_state state;
  fb_rk4_work work;
  int subnormal = 0;
  boom(FB_EFFECTS_FULL | FB_EFFECT_DAMPING, FB_BASE_PRESCRIBED, 2, 2, 0, 0.3);
  start(&state, 0.1, 0.0);
  for (int k = 0; k < 60000; k++) {
    FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, FB_R(0.02)), FB_OK);
    for (int a = 0; a < body.n; a++) {
      const double q = fabs((double)state.q[a]), pi = fabs((double)state.pi[a]);
      const double least = FBT_TOL(1e-300, 1e-30);
      subnormal += (q > 0.0 && q < least) || (pi > 0.0 && pi < least);
    }
  }
  FBT_INT_EQ(subnormal, 0);
  FBT_TRUE(fbt_largest(state.q, body.n) == 0.0 && fbt_largest(state.pi, body.n) == 0.0);
}

/* Hub rate of the spin-up, [DB] Figure 2 as a prescribed motion (reference p07C). */
static void spin_up(fb_input *input, double t)
{
  const double pi = 3.14159265358979324;
  memset(input, 0, sizeof *input);
  input->w[2] = (fb_real)(t < 15.0 ? 0.4 * (t - 15.0 / (2.0 * pi) * sin(2.0 * pi * t / 15.0)) : 6.0);
}

/* Tip deflection every half second of the spin-up with n bending modes. */
static fb_status spin_up_run(double *tip, int n, unsigned effects)
{
  const int per_row = 250;
  fb_state state;
  fb_rk4_work work;
  fb_input input[3];
  fb_motion motion;
  fb_node_motion node;
  boom(effects, FB_BASE_PRESCRIBED, n, 0, 0, 0.0);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  tip[0] = 0.0;
  for (int k = 0; k < 60 * per_row; k++) {
    fb_status status;
    for (int i = 0; i < 3; i++) {
      spin_up(&input[i], (k + 0.5 * i) * 0.5 / per_row);
    }
    status = fb_rk4_step(&body, &state, &work, &input[0], &input[1], &input[2], (fb_real)(0.5 / per_row));
    if (status != FB_OK) {
      return status;
    }
    if ((k + 1) % per_row == 0) {
      FBT_INT_EQ(fb_body_motion(&body, &motion, &state, &input[2]), FB_OK);
      FBT_INT_EQ(fb_body_node_motion(&body, &node, &state, &motion, 1), FB_OK);
      tip[(k + 1) / per_row] = (double)node.displacement[1];
    }
  }
  return FB_OK;
}

/* E8.2, E8.12, E8.17: three bending modes with all modal effects follow the geometrically exact beam to 0.2 % of the peak
   and the converged modal solution to 0.1 %; without spin stiffening the motion leaves the range and says so. */
TEST(spin_up_follows_the_geometrically_exact_beam)
{
  const fbt_table *table = fbt_reference("p07C_second_order.csv");
  static double three[61], many[61];
  double peak = 0.0, exact = 0.0, converged = 0.0;
  FBT_INT_EQ(table->rows, 61);
  FBT_INT_EQ(spin_up_run(three, 3, FB_EFFECTS_FULL), FB_OK);
  FBT_INT_EQ(spin_up_run(many, 8, FB_EFFECTS_FULL), FB_OK);
  for (int k = 0; k < table->rows; k++) {
    const double reference = fbt_value(table, k, "GE_u2");
    peak = fmax(peak, fabs(reference));
    exact = fmax(exact, fabs(three[k] - reference));
    converged = fmax(converged, fabs(three[k] - many[k]));
  }
  fbt_figure("spin-up, tip deflection of 3 modes / peak", "geometrically exact beam (p07C)", exact / peak);
  fbt_figure("spin-up, 3 modes against 8 / peak", "converged modal solution", converged / peak);
  FBT_BELOW(exact / peak, 0.002);
  FBT_BELOW(converged / peak, 0.001);
  FBT_INT_EQ(spin_up_run(many, 3, FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA), FB_ERR_RANGE);
}

/* Bad input returns its status and changes nothing; the same calls give the same bits. */
TEST(rk4_refuses_bad_input_and_repeats_itself)
{
  fb_state state, same, twin;
  fb_rk4_work work;
  fb_input input;
  const fb_real dt = FB_R(0.005);
  boom(FB_EFFECTS_FULL, FB_BASE_FREE, 2, 2, 0, 0.0);
  start(&state, 0.1, 0.3);
  same = twin = state;
  memset(&input, 0, sizeof input);
  FBT_INT_EQ(fb_rk4_step(NULL, &state, &work, NULL, NULL, NULL, dt), FB_ERR_NULL);
  FBT_INT_EQ(fb_rk4_step(&body, NULL, &work, NULL, NULL, NULL, dt), FB_ERR_NULL);
  FBT_INT_EQ(fb_rk4_step(&body, &state, NULL, NULL, NULL, NULL, dt), FB_ERR_NULL);
  FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, 0), FB_ERR_VALUE);
  FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, -dt), FB_ERR_VALUE);
  FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, (fb_real)NAN), FB_ERR_VALUE);
  FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, FB_R(10.0)), FB_ERR_STEP);
  input.n_load = -1;
  FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, &input, dt), FB_ERR_CAPACITY);
  input.n_load = 1;
  input.load[0].force[1] = (fb_real)NAN;
  FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, &input, NULL, dt), FB_ERR_NOT_FINITE);
  input.load[0].force[1] = FB_R(1e30);
  FBT_TRUE(fb_rk4_step(&body, &state, &work, &input, &input, &input, dt) != FB_OK);
  FBT_TRUE(memcmp(&same, &state, sizeof state) == 0);
  for (int k = 0; k < 100; k++) {
    FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, dt), FB_OK);
  }
  memset(&work, 0xA5, sizeof work); /* scratch is meaningless between calls */
  for (int k = 0; k < 100; k++) {
    FBT_INT_EQ(fb_rk4_step(&body, &twin, &work, NULL, NULL, NULL, dt), FB_OK);
    memset(&work, 0xA5, sizeof work);
  }
  FBT_TRUE(memcmp(&twin, &state, sizeof state) == 0);
}

SUITE(integrate, RUN(rk4_converges_with_order_four), RUN(tumbling_conserves_momentum_and_energy),
      RUN(the_step_limit_is_the_stability_boundary), RUN(the_step_limit_knows_the_acceleration_of_a_far_origin),
      RUN(decay_reaches_zero_without_subnormals), RUN(spin_up_follows_the_geometrically_exact_beam),
      RUN(rk4_refuses_bad_input_and_repeats_itself))
