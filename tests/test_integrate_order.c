/* >>integrate: orders, sums and what each integrator keeps: energy, momentum, phase. */
#include "integrate.h"

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

/* E8.18: unloaded and undamped, tumbling: linear and angular momentum to rounding over 1e6 steps with a coarse step;
   the drift of energy falls with at least the 4th power of the step. */
TEST(tumbling_conserves_momentum_and_energy)
{
  fb_state state;
  fb_rk4_work work;
  fb_momentum before, after;
  double drift[2];
  boom(FB_EFFECTS_FULL, FB_BASE_FREE, 1, 1, 0, 0.0);
  start(&state, 0.3, 0.5);
  FBT_INT_EQ(fb_body_momentum_eval(&body, &before, &state, NULL), FB_OK);
  for (int k = 0; k < FBT_LONG(1000000, 10000); k++) {
    if (fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, FB_R(0.01)) != FB_OK) {
      FBT_FAIL("every step is ok");
      break;
    }
  }
  FBT_INT_EQ(fb_body_momentum_eval(&body, &after, &state, NULL), FB_OK);
  fbt_figure("tumbling, 1e6 steps, linear momentum", "conservation",
             fbt_difference(before.linear, after.linear, 3) / fbt_largest(before.linear, 3));
  fbt_figure("tumbling, 1e6 steps, angular momentum", "conservation",
             fbt_difference(before.angular, after.angular, 3) / fbt_largest(before.angular, 3));
  FBT_NEAR_ABS(state.quat[0] * state.quat[0] + fb_vec3_dot(state.quat + 1, state.quat + 1), 1.0, FBT_TOL(2e-15, 1e-6));
  FBT_BELOW(fbt_difference(before.linear, after.linear, 3), FBT_TOL(1e-9, 1e-4) * fbt_largest(before.linear, 3));
  FBT_BELOW(fbt_difference(before.angular, after.angular, 3), FBT_TOL(1e-9, 1e-4) * fbt_largest(before.angular, 3));
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
      FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &input[2]), FB_OK);
      FBT_INT_EQ(fb_body_node_motion_eval(&body, &node, &state, &motion, 1), FB_OK);
      tip[(k + 1) / per_row] = (double)node.displacement[1];
    }
  }
  return FB_OK;
}

/* E8.2, E8.12, E8.17: three bending modes with all modal effects follow the geometrically exact beam to 0.2 % of the
   peak and the converged modal solution to 0.1 %; without spin stiffening the motion leaves the range and says so. */
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

/* ---- all integrators */

static const struct {
  const char *name;
  double order;
  int steps[2]; /* modes; nonlinear strain, where all modes are struck, the axial ones, too. rk4 is the reference */
} textbook[] = {{"rk4", 4.0, {0}},
                {"implicit midpoint", 2.0, {200, 4000}},
                {"SDIRK2", 2.0, {200, 4000}},
                {"exponential", 4.0, {50, 800}}};
FBT_ONE_EACH(textbook, INTEGRATORS);

/* Error of q, the attitude [rad] and the position [m] at t_end = 1 s with so many steps, against fine. */
static double error_of(integrator which, int steps, const fb_state *fine)
{
  const double dt = 1.0 / steps;
  fb_state state;
  fb_input input[3];
  fbt_seed(5);
  start(&state, 0.1, 0.3);
  prepare(which, dt);
  for (int k = 0; k < steps; k++) {
    for (int i = 0; i < 3; i++) {
      drive(&input[i], dt * (k + 0.5 * i));
    }
    FBT_INT_EQ(step(which, &state, &input[0], &input[1], &input[2], dt), FB_OK);
  }
  return fmax(fmax(fbt_difference(state.q, fine->q, body.n), fbt_difference(state.quat, fine->quat, 4)),
              fbt_difference(state.rho, fine->rho, 3));
}

static void order_of(integrator which, const fb_state *fine, double order, int steps, const char *what)
{
  const double coarse = error_of(which, steps, fine), half = error_of(which, 2 * steps, fine);
  if (!FB_SINGLE) {
    char text[96];
    snprintf(text, sizeof text, "order of %s, %s", textbook[which].name, what);
    fbt_figure(text, order > 3 ? "4" : "2", log2(coarse / half));
    FBT_NEAR_ABS(log2(coarse / half), order, 0.35);
  } else {
    FBT_BELOW(fmin(coarse, half), 5e-2); /* rounding hides the order */
  }
}

/* E11.4 to E11.8, E11.10: halving the step divides the error by 2^order; free and prescribed base, modes with the
   quadratic field and nonlinear strain, follower loads and base motion that vary within the step. */
TEST(each_integrator_converges_at_its_order)
{
  for (int k = 0; k < 4; k++) {
    const fb_base base = k % 2 ? FB_BASE_PRESCRIBED : FB_BASE_FREE;
    const char *const what = k == 0   ? "modes, free"
                             : k == 1 ? "modes, prescribed"
                             : k == 2 ? "nonlinear strain, free"
                                      : "nonlinear strain, prescribed";
    const int fine_steps = FBT_TOL(20000, 4000);
    fb_state fine;
    fb_input input[3];
    if (k < 2) {
      boom(FB_EFFECTS_FULL | FB_EFFECT_DAMPING, base, 2, 2, 0, 0.01);
    } else {
      strained(base, FBT_MOMENTUM, 1e5, 1);
    }
    fbt_seed(5);
    start(&fine, 0.1, 0.3);
    for (int i = 0; i < fine_steps; i++) {
      for (int m = 0; m < 3; m++) {
        drive(&input[m], (i + 0.5 * m) / fine_steps);
      }
      FBT_INT_EQ(step(RK4, &fine, &input[0], &input[1], &input[2], 1.0 / fine_steps), FB_OK);
    }
    body.allow_long_step = 1; /* the motion is smooth, the limit for any motion on this light hub is 2 ms */
    for (int which = RK4 + 1; which < INTEGRATORS; which++) {
      order_of((integrator)which, &fine, textbook[which].order, textbook[which].steps[k / 2], what);
    }
  }
}

/* E11.22: increments far below the rounding of what they are added to: a position 7000 km away that moves by 0.3 mm a
   step, an angular momentum that a torque changes by 1e-9 of it a step, an attitude that turns by 1e-9 rad a step. */
TEST(short_steps_lose_nothing)
{
  const double dt = 1e-4;
  const int steps = FBT_LONG(100000, 10000);
  for (int which = RK4; which < INTEGRATORS; which++) {
    const fb_real v[3] = {FB_R(3.0), FB_R(0.0), FB_R(0.0)}, w[3] = {FB_R(0.0), FB_R(0.0), FB_R(2.0)};
    const fb_real rest[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)}, slow[3] = {FB_R(0.0), FB_R(0.0), FB_R(1e-5)};
    fb_state state;
    fb_input input;
    fb_momentum before, after;
    boom(FB_EFFECTS_LINEAR, FB_BASE_FREE, 1, 1, 0, 0.0);
    prepare((integrator)which, dt);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, rest, NULL), FB_OK);
    state.rho[0] = FB_R(7e6);
    for (int k = 0; k < steps; k++) {
      FBT_INT_EQ(step((integrator)which, &state, NULL, NULL, NULL, dt), FB_OK);
    }
    FBT_NEAR_ABS(state.rho[0] - FB_R(7e6), 3.0 * dt * steps, FBT_TOL(1e-4, 0.51)); /* floats are 0.5 m apart there */
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_state_from_velocity(&body, &state, rest, w, NULL), FB_OK);
    memset(&input, 0, sizeof input);
    input.n_load = 1;
    input.load[0].torque[2] = FB_R(1e-3);
    FBT_INT_EQ(fb_body_momentum_eval(&body, &before, &state, NULL), FB_OK);
    for (int k = 0; k < steps; k++) {
      FBT_INT_EQ(step((integrator)which, &state, &input, &input, &input, dt), FB_OK);
    }
    FBT_INT_EQ(fb_body_momentum_eval(&body, &after, &state, NULL), FB_OK);
    FBT_NEAR_ABS(after.angular[2] - before.angular[2], 1e-3 * dt * steps, FBT_TOL(1e-8, 3e-4));
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_state_from_velocity(&body, &state, rest, slow, NULL), FB_OK);
    for (int k = 0; k < steps; k++) {
      FBT_INT_EQ(step((integrator)which, &state, NULL, NULL, NULL, dt), FB_OK);
    }
    FBT_NEAR_ABS(2.0 * (double)state.quat[3], 1e-5 * dt * steps, FBT_TOL(1e-9, 1e-7));
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, rest, NULL), FB_OK);
    FBT_INT_EQ(fb_body_momentum_eval(&body, &before, &state, NULL), FB_OK);
    input.load[0].force[0] = FB_R(1e-2);
    input.load[0].torque[2] = FB_R(0.0);
    for (int k = 0; k < steps; k++) {
      FBT_INT_EQ(step((integrator)which, &state, &input, &input, &input, dt), FB_OK);
    }
    FBT_INT_EQ(fb_body_momentum_eval(&body, &after, &state, NULL), FB_OK);
    FBT_NEAR_ABS(after.linear[0] - before.linear[0], 1e-2 * dt * steps, FBT_TOL(1e-8, 5e-4));
  }
}

/* E11.22: a mode that swings with a step of 1/15000 of its period, for 10 s: its cosine. */
TEST(slow_modes_keep_their_phase)
{
  const double dt = 1e-4;
  const int steps = FBT_LONG(100000, 10000);
  for (int which = RK4; which < INTEGRATORS; which++) {
    fb_state state;
    fb_input input;
    double omega, phase;
    boom(FB_EFFECTS_LINEAR, FB_BASE_PRESCRIBED, 1, 0, 0, 0.0);
    omega = sqrt((double)body.K.diagonal[0]);
    prepare((integrator)which, dt);
    memset(&input, 0, sizeof input);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    state.q[0] = FB_R(0.1);
    for (int k = 0; k < steps; k++) {
      FBT_INT_EQ(step((integrator)which, &state, &input, &input, &input, dt), FB_OK);
    }
    phase = omega * dt * steps;
    FBT_NEAR_ABS(state.q[0], 0.1 * cos(phase), FBT_TOL(2e-7, 2e-7));
    FBT_NEAR_ABS((double)state.pi[0] / omega, -0.1 * sin(phase), FBT_TOL(2e-7, 2e-7));
  }
}

/* Interface: two bodies stepped in turn give the bits of each alone: nothing is shared. */
TEST(bodies_stepped_in_turn_do_not_meet)
{
  static fb_body other;
  static const fb_body *const each[2] = {&body, &other};
  fb_rk4_work work;
  fb_state alone[2], turn[2];
  fb_input input;
  boom(FB_EFFECTS_FULL, FB_BASE_FREE, 1, 2, 0, 0.01);
  other = body;
  boom(FB_EFFECTS_SPIN, FB_BASE_PRESCRIBED, 2, 1, 0, 0.0);
  for (int k = 0; k < 2; k++) {
    FBT_INT_EQ(fb_state_init(each[k], &alone[k]), FB_OK);
    turn[k] = alone[k];
    for (int i = 0; i < 1000; i++) {
      drive(&input, 0.002 * i);
      FBT_INT_EQ(fb_rk4_step(each[k], &alone[k], &work, &input, &input, &input, FB_R(0.002)), FB_OK);
    }
  }
  for (int i = 0; i < 1000; i++) {
    drive(&input, 0.002 * i);
    for (int k = 0; k < 2; k++) {
      FBT_INT_EQ(fb_rk4_step(each[k], &turn[k], &work, &input, &input, &input, FB_R(0.002)), FB_OK);
    }
  }
  FBT_TRUE(memcmp(alone, turn, sizeof alone) == 0);
}

/* E11.7: unloaded and undamped: the implicit midpoint rule keeps the momenta to rounding and the energy within 1e-8
   over 1e6 steps. */
TEST(midpoint_keeps_energy_and_momentum)
{
  const int steps = FBT_LONG(FBT_TOL(1000000, 10000), 10000);
  fb_state state;
  fb_momentum before, after;
  double energy, worst = 0.0, momentum = 0.0;
  boom(FB_EFFECTS_FULL, FB_BASE_FREE, 1, 1, 0, 0.0);
  fbt_seed(1);
  start(&state, 0.02, 0.2);
  energy = energy_of(&state);
  FBT_INT_EQ(fb_body_momentum_eval(&body, &before, &state, NULL), FB_OK);
  for (int k = 0; k < steps; k++) {
    if (fb_midpoint_step(&body, &state, &implicit_work, NULL, FBT_TOL(FB_R(0.0005), FB_R(0.005)), FBT_TOL(4, 3)) !=
        FB_OK) {
      FBT_FAIL("every step is ok");
      break;
    }
    worst = k % 100 == 0 ? fmax(worst, fabs(energy_of(&state) / energy - 1.0)) : worst;
  }
  FBT_INT_EQ(fb_body_momentum_eval(&body, &after, &state, NULL), FB_OK);
  momentum = fmax(fbt_difference(before.linear, after.linear, 3) / fbt_largest(before.linear, 3),
                  fbt_difference(before.angular, after.angular, 3) / fbt_largest(before.angular, 3));
  fbt_figure(FBT_TOL(1, 0) ? "midpoint, 1e6 steps, energy" : "midpoint, 1e4 steps, energy", "conservation", worst);
  fbt_figure(FBT_TOL(1, 0) ? "midpoint, 1e6 steps, momenta" : "midpoint, 1e4 steps, momenta", "conservation", momentum);
  FBT_BELOW(worst, FBT_TOL(1e-8, 1e-3));
  FBT_BELOW(momentum, FBT_TOL(1e-10, 1e-3));
}

/* x in other axes: by k cyclically, x to y to z; 3: turned by half a turn about x. */
static void turned(fb_real y[3], const fb_real x[3], int k)
{
  for (int i = 0; i < 3; i++) {
    y[(i + k) % 3] = k == 3 && i > 0 ? -x[i] : x[i];
  }
}

/* Random particles on springs, in axes of the way k. */
static void turned_body(fb_base base, int form, int k)
{
  fb_real x[3], y[3], psi[6], moved[6];
  fbt_seed(11);
  FBT_INT_EQ(fb_shape_init(&shape, 2), FB_OK);
  for (int m = 0; m < 5; m++) {
    fbt_fill(x, 3, 1.0);
    fbt_fill(psi, 6, 0.3);
    turned(y, x, k);
    turned(moved, psi, k);
    turned(moved + 3, psi + 3, k);
    FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(0.5) + (fb_real)m, y, moved, NULL), FB_OK);
  }
  shape.K[0] = FB_R(60.0);
  shape.K[1] = shape.K[2] = FB_R(5.0);
  shape.K[3] = FB_R(40.0);
  memset(&body_desc, 0, sizeof body_desc);
  body_desc.effects = FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA;
  body_desc.base = base;
  body_desc.deflection_limit = FB_R(10.0);
  body_desc.allow_split_effects = body_desc.allow_long_step = 1;
  form_body(form);
}

/* A free or pinned one that drifts, spins and is pushed, after ten steps. */
static void turned_run(fb_state *state, integrator which, fb_base base, int form, int k)
{
  fb_real x[3], v[3], w[3];
  fb_input input;
  turned_body(base, form, k);
  FBT_INT_EQ(fb_state_init(&body, state), FB_OK);
  fbt_fill(state->q, 2, 0.3);
  fbt_fill(x, 3, base == FB_BASE_FREE ? 2.0 : 0.0);
  turned(v, x, k);
  fbt_fill(x, 3, 2.0);
  turned(w, x, k);
  FBT_INT_EQ(fb_form_state_from_velocity(&formed, state, v, w, NULL), FB_OK);
  memset(&input, 0, sizeof input);
  input.n_load = 1;
  fbt_fill(x, 3, 5.0);
  turned(input.load[0].force, x, k);
  fbt_fill(x, 3, 5.0);
  turned(input.load[0].torque, x, k);
  prepare(which, 0.02);
  for (int n = 0; n < 10; n++) {
    FBT_INT_EQ(which == EXPONENTIAL ? step(which, state, &input, &input, &input, 0.02)
                                    : form_step(which, state, &input, &input, &input, 0.02, 1),
               FB_OK);
  }
}

/* E11.3, E11.4, E11.7, E11.8, E11.10: no axis is better than another: the same body, motion and loads with x, y, z
   called y, z, x give the same motion, called so, by every integrator; of the implicit ones one iteration, whose matrix
   leaves its trace in it. */
TEST(integrators_know_no_axes)
{
  for (int run = 0; run < 2 * FBT_FORMS * INTEGRATORS; run++) {
    const fb_base base = run % 2 ? FB_BASE_PINNED : FB_BASE_FREE;
    const int form = run / 2 % FBT_FORMS;
    const integrator which = (integrator)(run / (2 * FBT_FORMS));
    fb_state first;
    if (which == EXPONENTIAL && form != FBT_MOMENTUM) {
      continue;
    }
    turned_run(&first, which, base, form, 0);
    for (int turn = 1; turn < 4; turn++) {
      const double tol = FBT_TOL(1e-12, 1e-4);
      fb_state other;
      fb_real y[3];
      turned_run(&other, which, base, form, turn);
      FBT_BELOW(fbt_difference(other.q, first.q, 2), tol);
      FBT_BELOW(fbt_difference(other.pi, first.pi, 2), tol * fbt_largest(first.pi, 2));
      turned(y, first.rho, turn);
      FBT_BELOW(fbt_difference(other.rho, y, 3), tol);
      turned(y, first.quat + 1, turn);
      FBT_BELOW(fbt_difference(other.quat + 1, y, 3), tol);
      turned(y, first.u, turn);
      FBT_BELOW(fbt_difference(other.u, y, 3), tol * fmax(fbt_largest(y, 3), 1.0));
      turned(y, first.L, turn);
      FBT_BELOW(fbt_difference(other.L, y, 3), tol * fbt_largest(y, 3));
    }
  }
}

/* A vector, or the vector part of a quaternion, of random components, turned. */
static void turned_fill(fb_real *x, int k, double size)
{
  fb_real y[3];
  fbt_fill(y, 3, size);
  turned(x, y, k);
}

/* Two of the bodies, the first free or on a ball joint, the second on a ball joint on it, askew, with springs and
   dampers, pushed, after ten steps of dt = 0.02 s by SDIRK with one iteration, or by rk4. */
static void turned_system_run(fb_system_state *state, int rk4, fb_joint_kind kind, int k)
{
  static fb_system_desc tree;
  static fb_system system;
  static fb_system_work system_work;
  static fb_system_input push;
  turned_body(FB_BASE_FREE, FBT_MOMENTUM, k);
  memset(&tree, 0, sizeof tree);
  memset(&push, 0, sizeof push);
  tree.n_body = push.n_load = 2;
  tree.allow_long_step = 1;
  for (int j = 0; j < 2; j++) {
    fb_joint_desc *const joint = &tree.joint[j];
    joint->kind = j ? FB_JOINT_SPHERICAL : kind;
    joint->parent = j ? 0 : FB_GROUND;
    turned_fill(joint->position, k, 1.0);
    turned_fill(joint->attitude + 1, k, 0.5);
    turned_fill(joint->child_position, k, 1.0);
    turned_fill(joint->child_attitude + 1, k, 0.5);
    joint->attitude[0] = joint->child_attitude[0] = FB_R(1.0);
    joint->stiffness[0] = joint->kind == FB_JOINT_FREE ? FB_R(0.0) : FB_R(80.0);
    joint->damping[0] = joint->kind == FB_JOINT_FREE ? FB_R(0.0) : FB_R(3.0);
    push.load[j].body = j;
    turned_fill(push.load[j].load.force, k, 5.0);
    turned_fill(push.load[j].load.torque, k, 5.0);
  }
  FBT_INT_EQ(fb_system_init(&system, &system_work, &body, &tree, 1), FB_OK);
  FBT_INT_EQ(fb_system_state_init(&system, &body, state, &system_work, NULL, NULL), FB_OK);
  for (int j = 0; j < 2; j++) {
    fb_link_state *const link = &state->link[j];
    fbt_fill(link->q, 2, 0.2);
    turned_fill(link->quat + 1, k, 1.0);
    FBT_INT_EQ(fb_quat_normalize(link->quat), FB_OK);
    turned_fill(link->p, k, 2.0);
    turned_fill(link->p + 3, k, tree.joint[j].kind == FB_JOINT_FREE ? 2.0 : 0.0);
  }
  for (int n = 0; n < 10; n++) {
    FBT_INT_EQ(rk4 ? fb_system_rk4_step(&system, &body, state, &system_work, &push, &push, &push, FB_R(0.02))
                   : fb_system_sdirk_step(&system, &body, state, &system_work, &push, &push, FB_R(0.02), 1),
               FB_OK);
  }
}

/* E11.12, E11.14: nor is one for systems. */
TEST(integrators_of_systems_know_no_axes)
{
  for (int run = 0; run < 4; run++) {
    const fb_joint_kind kind = run % 2 ? FB_JOINT_SPHERICAL : FB_JOINT_FREE;
    static fb_system_state first, other;
    turned_system_run(&first, run / 2, kind, 0);
    for (int turn = 1; turn < 4; turn++) {
      turned_system_run(&other, run / 2, kind, turn);
      for (int j = 0; j < 2; j++) {
        const double tol = FBT_TOL(1e-11, 1e-3);
        const fb_link_state *const a = &first.link[j], *const b = &other.link[j];
        const fb_real *const old[4] = {a->x, a->quat + 1, a->p, a->p + 3};
        const fb_real *const now[4] = {b->x, b->quat + 1, b->p, b->p + 3};
        for (int i = 0; i < 4; i++) {
          fb_real y[3];
          turned(y, old[i], turn);
          FBT_BELOW(fbt_difference(now[i], y, 3), tol * fmax(fbt_largest(y, 3), 1.0));
        }
        FBT_BELOW(fbt_difference(a->q, b->q, 2), tol);
        FBT_BELOW(fbt_difference(a->pi, b->pi, 2), tol * fbt_largest(a->pi, 2));
      }
    }
  }
}

/* E11.2: coordinates below FB_TINY and momenta below a millionth of it are zero after a step of any integrator, of a
   body and of a system, every one of them; momenta above stay as they are. */
TEST(what_is_tiny_becomes_zero)
{
  static fb_system_desc tree;
  static fb_system system;
  static fb_system_work system_work;
  static fb_system_state tree_state;
  boom(FB_EFFECTS_FULL, FB_BASE_FREE, 1, 1, 0, 0.0);
  tree.n_body = 1;
  tree.joint[0].kind = FB_JOINT_FREE;
  tree.joint[0].parent = FB_GROUND;
  FBT_INT_EQ(fb_system_init(&system, &system_work, &body, &tree, 1), FB_OK);
  for (int k = 0; k < 2 * (INTEGRATORS + 2); k++) {
    const int which = k / 2, above = k % 2;
    const fb_real size = (above ? FB_R(4.0) * (FB_R(1.0) + body.mass) : FB_R(0.25)) * FB_TINY * FB_R(1e-6); /* u, too */
    fb_state state;
    fb_link_state *const link = &tree_state.link[0];
    fb_momentum total;
    const fb_real *const P = which < INTEGRATORS ? state.u : above ? total.linear : link->p;
    const fb_real *const L = which < INTEGRATORS ? state.L : above ? total.angular : link->p + 3;
    const fb_real *const q = which < INTEGRATORS ? state.q : link->q, *const pi =
                                                                          which < INTEGRATORS ? state.pi : link->pi;
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_system_state_init(&system, &body, &tree_state, &system_work, NULL, NULL), FB_OK);
    for (int i = 0; i < 3; i++) {
      state.u[i] = state.L[i] = link->p[i] = link->p[3 + i] = size;
    }
    for (int a = 0; a < body.n && !above; a++) {
      state.q[a] = state.pi[a] = link->q[a] = link->pi[a] = size * FB_R(1e3); /* they swing by 100/s */
    }
    if (which < INTEGRATORS) {
      prepare((integrator)which, 1e-3);
      FBT_INT_EQ(step((integrator)which, &state, NULL, NULL, NULL, 1e-3), FB_OK);
    } else {
      FBT_INT_EQ(which == INTEGRATORS
                     ? fb_system_rk4_step(&system, &body, &tree_state, &system_work, NULL, NULL, NULL, FB_R(1e-3))
                     : fb_system_sdirk_step(&system, &body, &tree_state, &system_work, NULL, NULL, FB_R(1e-3), 0),
                 FB_OK);
      FBT_TRUE(above == (fbt_largest(link->u, 3) > 0.0)); /* that is where linear momentum goes */
      FBT_INT_EQ(fb_system_momentum_eval(&system, &body, &system_work, &total, &tree_state, NULL), FB_OK);
    }
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_REL(P[i], above ? size : FB_R(0.0), 8.0 * (double)FB_EPSILON);
      FBT_NEAR_REL(L[i], above ? size : FB_R(0.0), 8.0 * (double)FB_EPSILON);
    }
    FBT_TRUE(above || (fbt_largest(q, body.n) == 0.0 && fbt_largest(pi, body.n) == 0.0));
  }
}

/* What a base does that turns by input->w and goes straight on in space, a time after it stood at an attitude. */
static void straight_on(fb_input *input, const fb_real quat[4], const fb_real v[3], double after)
{
  fb_real turn[3], more[4], now[4], R[9];
  for (int i = 0; i < 3; i++) {
    turn[i] = (fb_real)after * input->w[i];
  }
  fb_quat_from_rotvec(more, turn);
  fb_quat_mul(now, quat, more);
  fb_quat_to_mat33(R, now);
  fb_mat33_mulT_vec3(input->v, R, v);
  fb_vec3_cross(input->v_dot, input->v, input->w);
}

/* A tumbling, bending body with a thruster on its tip, at a speed along some direction: what it does relative to its
   mass center after 2 s, and where O is against the way at that speed. */
static void fly(fb_state *state, fb_node_motion *tip, integrator which, fb_base base, const fb_body_desc *desc,
                double speed)
{
  const double dt = 0.002;
  const fb_real direction[3] = {FB_R(0.6), -FB_R(0.64), FB_R(0.48)}, w[3] = {FB_R(0.02), FB_R(0.03), FB_R(0.3)};
  fb_real still[3], q_dot[FB_MAX_MODES]; /* its velocity in space */
  fb_input input;
  fb_motion motion;
  body_desc = *desc;
  body_desc.base = base;
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &body_desc), FB_OK);
  prepare(which, dt);
  FBT_INT_EQ(fb_state_init(&body, state), FB_OK);
  fbt_seed(11);
  fbt_fill(state->q, body.n, 0.3);
  fbt_fill(q_dot, body.n, 0.3);
  for (int i = 0; i < 3; i++) {
    still[i] = (fb_real)speed * direction[i] + FB_R(0.1) * (fb_real)i;
  }
  memset(&input, 0, sizeof input);
  input.n_load = 1;
  input.load[0].node = 1;
  input.load[0].axes = FB_AXES_NODE;
  input.load[0].force[1] = FB_R(1.0);
  memcpy(input.v, still, sizeof still);
  memcpy(input.w, w, sizeof w);
  FBT_INT_EQ(fb_state_from_velocity(&body, state, still, w, q_dot), FB_OK);
  for (int k = 0; k < 1000; k++) {
    fb_input at[3];
    for (int stage = 0; stage < 3; stage++) {
      at[stage] = input;
      if (base == FB_BASE_PRESCRIBED) {
        straight_on(&at[stage], state->quat, still, 0.5 * stage * dt);
      }
    }
    FBT_INT_EQ(step(which, state, &at[0], &at[1], &at[2], dt), FB_OK);
  }
  if (base == FB_BASE_PRESCRIBED) {
    straight_on(&input, state->quat, still, 0.0);
  }
  FBT_INT_EQ(fb_body_motion_eval(&body, &motion, state, &input), FB_OK);
  FBT_INT_EQ(fb_body_node_motion_eval(&body, tip, state, &motion, 1), FB_OK);
}

/* Bending and deflection of the tip are those at rest, to tol; returns by how much of the bending they are not. */
static double bends_alike(const fb_state *state, const fb_node_motion *tip, const fb_state *rest,
                          const fb_node_motion *tip_rest, double tol)
{
  const double size = fbt_largest(rest->q, body.n), off = fbt_difference(state->q, rest->q, body.n);
  FBT_TRUE(fbt_largest(tip_rest->displacement, 3) > 0.01);
  FBT_BELOW(off, tol * size);
  FBT_BELOW(fbt_difference(tip->displacement, tip_rest->displacement, 3), 10.0 * tol);
  return off / size;
}

/* E8.33, E8.35, E11.31: Galileo's principle: at 100 m/s to 30 km/s a free body bends and turns as one at rest, by every
   integrator; what an accelerometer on it reads is the same, too. */
TEST(flight_speed_does_not_matter)
{
  static const double speeds[] = {100.0, 250.0, 7500.0, 30000.0};
  static const unsigned sets[] = {FB_EFFECTS_FULL, FB_EFFECTS_LINEAR};
  double worst = 0.0;
  for (int run = 0; run < 2 * INTEGRATORS; run++) {
    const integrator which = (integrator)(run % INTEGRATORS);
    fb_body_desc desc;
    fb_state rest;
    fb_node_motion tip_rest;
    boom(sets[run / INTEGRATORS], FB_BASE_FREE, 2, 2, 0, 0.0);
    desc = body_desc;
    desc.allow_long_step = 1; /* the exponential scheme's limit is that of any motion */
    fly(&rest, &tip_rest, which, FB_BASE_FREE, &desc, 0.0);
    for (int k = 0; k < FBT_COUNT(speeds); k++) {
      const double tol = FBT_TOL(1e-9, 2e-5);
      fb_state state;
      fb_node_motion tip;
      fly(&state, &tip, which, FB_BASE_FREE, &desc, speeds[k]);
      worst = fmax(worst, bends_alike(&state, &tip, &rest, &tip_rest, tol));
      FBT_BELOW(fbt_difference(state.quat, rest.quat, 4), tol);
      FBT_BELOW(fbt_difference(state.L, rest.L, 3), tol * fbt_largest(rest.L, 3));
      FBT_BELOW(fbt_difference(tip.acceleration, tip_rest.acceleration, 3),
                10.0 * tol * fbt_largest(tip_rest.acceleration, 3));
    }
  }
  fbt_figure("bending at 30 km/s", "the same at rest", worst);
}

/* E8.35, E11.31, E11.34: a base that is prescribed to turn and to go straight on bends what hangs on it as one that
   turns in place. The caller rounds v in body axes, by eps of the speed, and turns it by the exact attitude, which
   implicit integrators have but for (w dt)^3/12: 2e-11 of the speed. */
TEST(the_speed_of_a_prescribed_base_does_not_matter)
{
  static const double speeds[] = {250.0, 7500.0, 30000.0};
  double worst = 0.0;
  for (int run = 0; run < 2 * INTEGRATORS; run++) {
    const integrator which = (integrator)(run % INTEGRATORS);
    fb_body_desc desc;
    fb_state rest;
    fb_node_motion tip_rest;
    boom(run < INTEGRATORS ? FB_EFFECTS_FULL : FB_EFFECTS_LINEAR, FB_BASE_PRESCRIBED, 2, 2, 0, 0.0);
    desc = body_desc;
    fly(&rest, &tip_rest, which, FB_BASE_PRESCRIBED, &desc, 0.0);
    for (int k = 0; k < FBT_COUNT(speeds); k++) {
      const double tol = FBT_TOL(1e-9, 2e-5) + speeds[k] * FBT_TOL(1e-11, 1e-7);
      fb_state state;
      fb_node_motion tip;
      fly(&state, &tip, which, FB_BASE_PRESCRIBED, &desc, speeds[k]);
      worst = fmax(worst, bends_alike(&state, &tip, &rest, &tip_rest, tol));
      FBT_BELOW(fbt_difference(state.quat, rest.quat, 4), FBT_TOL(1e-12, 1e-5));
    }
  }
  fbt_figure("bending on a base at 30 km/s", "the same at rest", worst);
}

/* E11.22, E11.30: a body that tumbles for 60 s at 7.5 km/s is where its mass center leads it: rho + R c/m is at the
   start's + u t, to rounding of the way, in both precisions; the angular momentum about the inertial origin stays. */
TEST(the_mass_center_goes_where_momentum_leads_it)
{
  const double dt = 0.01, n = 6000;
  double at[2][3], worst = 0.0;
  fb_state state;
  fb_rk4_work work;
  fb_real v[3] = {FB_R(7500.0), FB_R(0.5), -FB_R(0.25)}, w[3] = {FB_R(0.1), -FB_R(0.2), FB_R(0.3)};
  boom(FB_EFFECTS_FULL, FB_BASE_FREE, 2, 2, 0, 0.0);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  fbt_seed(3);
  fbt_fill(state.q, body.n, 0.3);
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, w, NULL), FB_OK);
  for (int k = 0; k < 2; k++) {
    double c[3];
    fb_real R[9];
    for (int i = 0; i < 3; i++) {
      c[i] = (double)shape.c[i];
      for (int a = 0; a < body.n; a++) {
        c[i] += (double)(shape.P[3 * a + i] * state.q[a]);
        for (int b = 0; b < body.n; b++) {
          c[i] += 0.5 * (double)(shape.second.pchi[3 * (a * body.n + b) + i] * state.q[a] * state.q[b]);
        }
      }
    }
    fb_quat_to_mat33(R, state.quat);
    for (int i = 0; i < 3; i++) {
      at[k][i] = (double)state.rho[i] + (double)state.lost_rho[i];
      for (int j = 0; j < 3; j++) {
        at[k][i] += (double)R[3 * i + j] * c[j] / (double)shape.mass;
      }
    }
    for (int i = 0; i < (int)n && k == 0; i++) {
      FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, (fb_real)dt), FB_OK);
    }
  }
  for (int i = 0; i < 3; i++) {
    const double way = (double)(fb_real)dt * n * (double)state.u[i];
    worst = fmax(worst, fabs(at[1][i] - at[0][i] - way) / (1.0 + fabs(way)));
  }
  FBT_BELOW(worst, FBT_TOL(1e-14, 1e-6));
}

/* E11.22: in both precisions a position is the sum of its increments, however far from the origin: 1e5 steps of 0.1 um
   at 7e6 m (1e12 m in double) are 1 cm. */
TEST(positions_are_sums_without_loss)
{
  const double far = FBT_TOL(1e12, 7e6);
  fb_state state;
  fb_rk4_work work;
  const fb_real v[3] = {FB_R(1e-3), 0, 0}, w[3] = {0};
  boom(FB_EFFECTS_LINEAR, FB_BASE_FREE, 1, 1, 0, 0.0);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, w, NULL), FB_OK);
  state.rho[0] = (fb_real)far;
  for (int k = 0; k < 100000; k++) {
    FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, FB_R(1e-4)), FB_OK);
  }
  FBT_NEAR_ABS(((double)state.rho[0] - far) + (double)state.lost_rho[0], 0.01,
               FBT_TOL(1e-8, 5e-5)); /* 1e5 roundings of what is kept, 0.01 at most */
}

/* E11.22: a force of 0.4 uN adds up in 100 kg that fly at 7.5 km/s, and a torque of 10 pN m in a body of a gram, step
   by step, in both precisions. */
TEST(the_faintest_loads_add_up)
{
  const double dt = 1e-3;
  for (int light = 0; light < 2; light++) {
    const fb_real center[3] = {0}, v[3] = {light ? FB_R(0.0) : FB_R(7500.0), 0, 0};
    const fb_real J = light ? FB_R(1.5e-7) : FB_R(20.0), inertia[6] = {J, J, J, 0, 0, 0};
    fb_rk4_work work;
    fb_input input;
    fb_state state;
    fb_motion motion;
    memset(&input, 0, sizeof input);
    memset(&body_desc, 0, sizeof body_desc);
    input.n_load = 1;
    input.load[0].force[0] = light ? FB_R(0.0) : FB_R(4e-7);
    input.load[0].torque[2] = light ? FB_R(1e-11) : FB_R(0.0);
    FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, light ? FB_R(1e-3) : FB_R(100.0), center, inertia), FB_OK);
    FBT_INT_EQ(fb_shape_add_node(&shape, &input.load[0].node, center, NULL, NULL), FB_OK);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &body_desc), FB_OK);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, center, NULL), FB_OK);
    for (int k = 0; k < 10000; k++) {
      FBT_INT_EQ(fb_rk4_step(&body, &state, &work, &input, &input, &input, (fb_real)dt), FB_OK);
    }
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, NULL), FB_OK);
    if (light) {
      FBT_NEAR_REL(motion.w[2], 1e-11 * 10.0 / 1.5e-7, FBT_TOL(1e-9, 1e-4));
    } else {
      FBT_NEAR_REL(((double)state.u[0] - 7500.0) + (double)state.lost_u[0], 4e-8, FBT_TOL(1e-4, 1e-3));
    }
  }
}

/* A rigid tube of 1 kg, 10 m long, whose inertia about its axis is `ratio` of the others, which turns across it. */
static void tube(fb_state *state, double ratio)
{
  const fb_real center[3] = {0}, v[3] = {0}, w[3] = {0, FB_R(0.2), FB_R(0.2)};
  const fb_real inertia[6] = {(fb_real)(ratio * 25.0 / 3.0), FB_R(25.0) / FB_R(3.0), FB_R(25.0) / FB_R(3.0)};
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(1.0), center, inertia), FB_OK);
  memset(&body_desc, 0, sizeof body_desc);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &body_desc), FB_OK);
  FBT_INT_EQ(fb_state_init(&body, state), FB_OK);
  for (int i = 0; i < 4; i++) {
    state->quat[i] = (fb_real)(0.5 + 0.1 * i);
  }
  FBT_INT_EQ(fb_quat_normalize(state->quat), FB_OK);
  FBT_INT_EQ(fb_state_from_velocity(&body, state, v, w, NULL), FB_OK);
}

/* E8.18, E11.29: rods whose inertia about their axis is 1e-4 to 1e-8 of that across (single precision: 1e-2 to 1e-4; a
   thinner one is refused by the pivots of its S) keep their energy and their angular momentum, by every integrator: the
   attitude's error does not become spin about the axis, however many steps there are. */
TEST(slender_bodies_keep_their_energy)
{
  for (int run = 0; run < 4 * 5; run++) {
    const integrator which = (integrator)(run % 4);
    const double ratio = pow(10.0, FBT_TOL(-4 - run / 4, -2 - 0.5 * (run / 4))), dt = which == RK4 ? 0.85 : 0.1;
    const int n = FBT_LONG(100000, 2000);
    double energy, spin = 0.0;
    fb_state state;
    fb_momentum before, after;
    fb_motion motion;
    tube(&state, ratio);
    prepare(which, dt);
    energy = energy_of(&state);
    FBT_INT_EQ(fb_body_momentum_eval(&body, &before, &state, NULL), FB_OK);
    for (int k = 0; k < n; k++) {
      FBT_INT_EQ(step(which, &state, NULL, NULL, NULL, dt), FB_OK);
    }
    FBT_INT_EQ(fb_body_momentum_eval(&body, &after, &state, NULL), FB_OK);
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, NULL), FB_OK);
    spin = fabs((double)motion.w[0]);
    FBT_NEAR_REL(energy_of(&state), energy, FBT_TOL(1e-9, 1e-5));
    FBT_BELOW(fbt_difference(after.angular, before.angular, 3), FBT_TOL(1e-14, 1e-6) * fbt_largest(before.angular, 3));
    FBT_BELOW(spin, FBT_TOL(1e-4, 0.1));
  }
}

SUITE(integrate_order, RUN(flight_speed_does_not_matter), RUN(the_speed_of_a_prescribed_base_does_not_matter),
      RUN(the_mass_center_goes_where_momentum_leads_it), RUN(positions_are_sums_without_loss),
      RUN(the_faintest_loads_add_up), RUN(slender_bodies_keep_their_energy), RUN(integrators_know_no_axes),
      RUN(integrators_of_systems_know_no_axes), RUN(what_is_tiny_becomes_zero),
      RUN_LONG(each_integrator_converges_at_its_order), RUN(midpoint_keeps_energy_and_momentum),
      RUN(rk4_converges_with_order_four), RUN(tumbling_conserves_momentum_and_energy), RUN(short_steps_lose_nothing),
      RUN(slow_modes_keep_their_phase), RUN(bodies_stepped_in_turn_do_not_meet),
      RUN(decay_reaches_zero_without_subnormals), RUN(spin_up_follows_the_geometrically_exact_beam))
