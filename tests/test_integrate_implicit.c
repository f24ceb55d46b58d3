/* >>integrate: the implicit and the exponential scheme: iterations, tangent, stiff modes, drift. */
#include "integrate.h"

/* ---- all integrators */

/* E11.4, E11.6, E11.8, E11.10: a step of 1000 periods of the stiffest mode, slow motion and all modes struck: every
   integrator stays finite or says why not, the L-stable one lets no energy grow. */
TEST(steps_may_be_a_thousand_periods_long)
{
  for (int which = RK4; which < INTEGRATORS; which++) {
    for (int base = 0; base < 2; base++) {
      const fb_real v[3] = {0}, w[3] = {0, 0, base ? 0 : FB_R(0.01)};
      fb_real qd[FB_MAX_MODES];
      fb_state state, before;
      double energy, last, dt;
      fb_status status = FB_OK;
      strained(base ? FB_BASE_PRESCRIBED : FB_BASE_FREE, FBT_MOMENTUM, 3e7, 1);
      dt = 1000.0 * 2.0 * 3.14159265358979 / sqrt((double)body.limit_elastic);
      body.allow_long_step = which == EXPONENTIAL;
      prepare((integrator)which, dt);
      FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
      fbt_fill(qd, body.n, FBT_TOL(1e-3, 1e-3));
      FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, w, qd), FB_OK);
      energy = last = energy_of(&state);
      before = state;
      for (int k = 0; k < 300 && status == FB_OK; k++) {
        status = step((integrator)which, &state, NULL, NULL, NULL, dt);
        if (which == SDIRK) {
          /* the spin of the free body is no mode: (w dt)^3 */
          FBT_TRUE(energy_of(&state) <=
                   last * (1.0 + FBT_TOL(base ? 1e-12 : 1e-7, 1e-3)) + FBT_TOL(1e-15, 1e-6) * energy);
          last = energy_of(&state);
        }
      }
      if (which == RK4) { /* refused, nothing lost */
        FBT_INT_EQ(status, FB_ERR_STEP);
        FBT_TRUE(memcmp(&state, &before, sizeof state) == 0);
      } else {
        FBT_INT_EQ(status, FB_OK);
        FBT_INT_EQ(fb_state_check(&body, &state), FB_OK);
        FBT_BELOW(energy_of(&state), (which == SDIRK ? 1.0 + 1e-6 : 10.0) * energy);
      }
    }
  }
}

/* What one iteration of the midpoint rule leaves of q, pi, position and h, deflected, spinning and drifting as far as
   the base lets it. */
static void left_by_one(double left[4], double dt)
{
  fb_state end[2];
  for (int i = 0; i < 2; i++) {
    const fb_real none[FB_MAX_MODES] = {0};
    fb_real v[3], w[3];
    fbt_seed(5);
    FBT_INT_EQ(fb_state_init(&body, &end[i]), FB_OK);
    fbt_fill(end[i].q, body.n, 0.3);
    fbt_fill(v, 3, body.base == FB_BASE_FREE ? 0.3 : 0.0);
    fbt_fill(w, 3, 4.0);
    FBT_INT_EQ(fb_state_from_velocity(&body, &end[i], v, w, none), FB_OK);
    FBT_INT_EQ(fb_midpoint_step(&body, &end[i], &implicit_work, NULL, (fb_real)dt, i ? 30 : 1), FB_OK);
  }
  left[0] = fbt_difference(end[0].q, end[1].q, body.n);
  left[1] = fbt_difference(end[0].pi, end[1].pi, body.n);
  left[2] = fbt_difference(end[0].rho, end[1].rho, 3);
  left[3] = fbt_difference(end[0].h, end[1].h, 3);
}

/* E11.4, E11.5: of the equations without a quadratic field the matrix is the Jacobian, and what an iteration leaves is
   of order 5 in q and of order 4 in what forces change first: by any other matrix it is of one order less. Mass off the
   line in every direction, a base that may move and one that may turn. */
TEST(iterations_are_newtons)
{
  static const fb_base base[] = {FB_BASE_FREE, FB_BASE_PINNED};
  static const fb_real off[3] = {FB_R(0.8), -FB_R(1.1), FB_R(0.9)}, inertia[6] = {FB_R(1.0), FB_R(1.0), FB_R(1.0)};
  for (int k = 0; k < 2 && !FB_SINGLE; k++) { /* there rounding hides the order */
    double whole[4], half[4];
    boom(FB_EFFECTS_SPIN, base[k], 2, 2, 0, 0.02);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(10.0), off, inertia), FB_OK);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &body_desc), FB_OK);
    left_by_one(whole, 0.004);
    left_by_one(half, 0.002);
    for (int i = 0; i < (base[k] == FB_BASE_FREE ? 4 : 2); i++) {
      FBT_TRUE(half[i] > 1e-14);
      FBT_BELOW(i == 0 ? 4.9 : 3.9, log2(whole[i] / half[i]));
    }
  }
}

/* E11.4, E11.5: a free body on a light hub that drifts at 20 m/s, three iterations of the midpoint rule at 2 ms:
   energy as at rest; the same motion however it is turned. */
TEST(implicit_integrators_do_not_mind_drift)
{
  const fb_real v[3] = {0, 0, FB_R(20.0)}, w[3] = {0};
  strained(FB_BASE_FREE, FBT_MOMENTUM, 1e5, 1);
  fbt_seed(3);
  for (int turn = 0; turn < 4; turn++) {
    static fb_state first;
    fb_state state;
    double energy, elastic;
    fb_energy e;
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    if (turn > 0) {
      fbt_fill(state.quat, 4, 1.0);
      FBT_INT_EQ(fb_quat_normalize(state.quat), FB_OK);
    }
    state.q[0] = state.q[1] = FB_R(0.01);
    FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, w, NULL), FB_OK);
    FBT_INT_EQ(fb_body_energy_eval(&body, &e, &state, NULL), FB_OK);
    elastic = (double)e.strain;
    energy = energy_of(&state);
    for (int k = 0; k < 1000; k++) {
      FBT_INT_EQ(fb_midpoint_step(&body, &state, &implicit_work, NULL, FB_R(0.002), 3), FB_OK);
    }
    FBT_DOUBLE_ONLY("1.2e-3 of 6400 J")
    {
      FBT_NEAR_ABS(energy_of(&state), energy, 1e-8 * elastic);
    }
    (void)energy, (void)elastic; /* not read in single precision */
    FBT_BELOW(fbt_largest(state.q, body.n), 0.1);
    first = turn ? first : state;
    FBT_BELOW(fbt_difference(state.q, first.q, body.n), FBT_TOL(1e-11, 1e-4));
  }
}

/* E11.9: with s = q + G(q) the forces on the axial coordinates, with nothing else at work, are -(K s)_a: linear. */
TEST(membrane_coordinates_make_the_strain_linear)
{
  fb_state state, rate;
  double worst = 0.0, largest = 0.0;
  strained(FB_BASE_PRESCRIBED, FBT_MOMENTUM, 1e5, 1);
  prepare(EXPONENTIAL, 0.01);
  FBT_INT_EQ(exponential.n_axial, 5); /* two cubic elements and the root function */
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  fbt_fill(state.q, body.n, 0.3);
  FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, NULL), FB_OK);
  for (int i = 0; i < exponential.n_axial; i++) {
    const int a = exponential.axial[i];
    double force = 0.0;
    for (int j = 0; j < exponential.n_axial; j++) {
      const int b = exponential.axial[j];
      double s = (double)state.q[b];
      for (int g = 0; g < body.n_strain; g++) {
        double slope[3] = {0, 0, 0};
        for (int row = 0; row < body.n_strain_row; row++) {
          slope[body.strain_row[row].axis] +=
              (double)body.strain_row[row].slope[g] * (double)state.q[body.strain_row[row].a];
        }
        s += (double)exponential.G[j * ((FB_MAX_STRAINS + 3) / 4 * 4) + g] * 0.5 *
             (slope[1] * slope[1] + slope[2] * slope[2]);
      }
      force -= (double)shape.K[a * body.n + b] * s;
    }
    worst = fmax(worst, fabs(force - (double)rate.pi[a]));
    largest = fmax(largest, fabs(force));
  }
  FBT_ZERO(worst, largest, FBT_TOL(1e-12, 1e-4));
}

/* E8.29: the matrix of the implicit steppers against central differences of the elastic forces; stretched beam, so
   that no compression is left out. */
TEST(the_tangent_is_the_derivative_of_the_forces)
{
  const double h = FBT_TOL(1e-5, 3e-3);
  double worst = 0.0, largest = 0.0;
  fb_state state, moved, up, down;
  strained(FB_BASE_PRESCRIBED, FBT_MOMENTUM, 1e5, 1);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  fbt_fill(state.q, body.n, 0.05);
  state.q[2] += FB_R(3.0); /* the first function along x: some 10 % of stretch */
  moved = state;
  FBT_INT_EQ(fb_midpoint_step(&body, &moved, &implicit_work, NULL, FB_R(1e-4), 1), FB_OK);
  for (int b = 0; b < body.n; b++) {
    moved = state;
    moved.q[b] = state.q[b] + (fb_real)h;
    FBT_INT_EQ(fb_body_rates_eval(&body, &up, &moved, NULL), FB_OK);
    moved.q[b] = state.q[b] - (fb_real)h;
    FBT_INT_EQ(fb_body_rates_eval(&body, &down, &moved, NULL), FB_OK);
    for (int a = 0; a < body.n; a++) {
      const double K = ((double)down.pi[a] - (double)up.pi[a]) / (2.0 * h);
      worst = fmax(worst, fabs(K - (double)implicit_work.K[a * body.n + b]));
      largest = fmax(largest, fabs(K));
    }
  }
  FBT_ZERO(worst, largest, FBT_TOL(1e-7, 1e-2));
}

/* E11.10: a linear body without loads is propagated exactly by any step, free or held. */
TEST(the_exponential_integrator_is_exact_for_linear_bodies)
{
  for (int k = 0; k < 4; k++) {
    static const fb_base base[] = {FB_BASE_FREE, FB_BASE_PRESCRIBED, FB_BASE_PINNED, FB_BASE_FREE};
    const fb_real v[3] = {0}, w[3] = {0}, inertia[6] = {FB_R(40.0), FB_R(30.0), FB_R(50.0), 0, 0, 0};
    fb_real qd[FB_MAX_MODES];
    fb_state state, fine;
    double energy;
    boom(FB_EFFECTS_LINEAR, base[k], 2, 2, 0, 0.0);
    if (k == 3) { /* functions, whose mass matrix is not 1 */
      strained_beam(1, 1e4, 9000.0, 0);
      FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(20.0), v, inertia), FB_OK);
      body_desc.effects = FB_EFFECTS_LINEAR;
      FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &body_desc), FB_OK);
    }
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    fbt_seed(9);
    fbt_fill(state.q, body.n, 1e-4); /* so small that the recoil's turning of P and L is below rounding */
    fbt_fill(qd, body.n, 1e-4);
    FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, w, qd), FB_OK);
    memset(state.u, 0, sizeof state.u);
    memset(state.L, 0, sizeof state.L);
    fine = state;
    energy = energy_of(&state);
    prepare(EXPONENTIAL, 1.0);
    FBT_INT_EQ(step(EXPONENTIAL, &state, NULL, NULL, NULL, 1.0), FB_OK);
    for (int i = 0; i < FBT_TOL(40000, 4000); i++) {
      FBT_INT_EQ(step(RK4, &fine, NULL, NULL, NULL, 1.0 / FBT_TOL(40000, 4000)), FB_OK);
    }
    FBT_BELOW(fbt_difference(state.q, fine.q, body.n), FBT_TOL(1e-12, 1e-6));
    FBT_NEAR_REL(energy_of(&state), energy, FBT_TOL(1e-12, 1e-4));
  }
}

/* E11.10: so it is under a load that stays, whatever part of a period a step is: one step of dt is four of dt/4. */
TEST(the_exponential_integrator_is_exact_for_constant_loads)
{
  double largest = 0.0;
  boom(FB_EFFECTS_LINEAR, FB_BASE_PRESCRIBED, 2, 2, 0, 0.0);
  for (double dt = 1e-3; dt < 10.0; dt *= 1.3) {
    fb_state once, parts;
    fb_input input;
    memset(&input, 0, sizeof input);
    input.n_load = 1;
    input.load[0].node = 1;
    input.load[0].force[1] = FB_R(0.1);
    input.load[0].force[2] = FB_R(0.2);
    FBT_INT_EQ(fb_state_init(&body, &once), FB_OK);
    parts = once;
    prepare(EXPONENTIAL, dt);
    FBT_INT_EQ(step(EXPONENTIAL, &once, &input, &input, &input, dt), FB_OK);
    prepare(EXPONENTIAL, 0.25 * dt);
    for (int k = 0; k < 4; k++) {
      FBT_INT_EQ(step(EXPONENTIAL, &parts, &input, &input, &input, 0.25 * dt), FB_OK);
    }
    largest = fmax(largest, fbt_difference(parts.q, once.q, body.n) / fbt_largest(once.q, body.n));
  }
  FBT_BELOW(largest, FBT_TOL(1e-12, 1e-4));
}

/* E11.10: the tables of the exponential scheme are the series sum (-t^2)^k/(2k + j)! of t = omega dt and half of that,
   in steps short and long. */
TEST(the_exponential_integrator_knows_its_functions)
{
  boom(FB_EFFECTS_LINEAR, FB_BASE_PRESCRIBED, 2, 2, 0, 0.0);
  for (double t = 0.05; t < 4.0; t += 0.15) {
    prepare(EXPONENTIAL, t / (double)modes.omega[0]);
    for (int at = 0; at < 2 * body.n; at++) {
      const int k = at / 2, half = at % 2;
      const double x = (double)exponential.dt * sqrt((double)exponential.omega2[k]) * (half ? 0.5 : 1.0);
      for (int j = 0; j < 5 && x < 6.0; j++) {
        double sum = 0.0, term = j < 2 ? 1.0 : j == 2 ? 0.5 : j == 3 ? 1.0 / 6.0 : 1.0 / 24.0;
        for (int i = 1; i < 30; i++) {
          sum += term;
          term *= -x * x / ((2 * i + j - 1) * (2 * i + j));
        }
        FBT_NEAR_ABS(half ? exponential.half[j][k] : exponential.full[j][k], sum, FBT_TOL(3e-13, 2e-5));
      }
    }
  }
}

/* The spin-up by a prescribed hub, three cubic elements: largest error of the tip's deflection every 0.5 s against
   rk4 at 0.125 ms, both relative to the peak. */
static double spin_up_tip(integrator which, double dt, double t_end, double *tip)
{
  const int steps = (int)floor(t_end / dt + 0.5), stride = (int)floor(0.5 / dt + 0.5);
  const double turn = 2.0 * 3.14159265358979323846 / 15.0;
  double worst = 0.0, peak = 0.0;
  fb_state state;
  fb_input input[3];
  fb_motion motion;
  fb_node_motion at;
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  prepare(which, dt);
  memset(input, 0, sizeof input);
  for (int k = 0; k < steps; k++) {
    for (int i = 0; i < 3; i++) {
      const double t = dt * (k + 0.5 * i);
      input[i].w[2] = (fb_real)(6.0 / 15.0 * (t - sin(turn * t) / turn));
      input[i].w_dot[2] = (fb_real)(6.0 / 15.0 * (1.0 - cos(turn * t)));
    }
    FBT_INT_EQ(step(which, &state, &input[0], &input[1], &input[2], dt), FB_OK);
    if ((k + 1) % stride == 0) {
      double *reference = &tip[(k + 1) / stride];
      FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &input[2]), FB_OK);
      FBT_INT_EQ(fb_body_node_motion_eval(&body, &at, &state, &motion, 1), FB_OK);
      *reference = which == RK4 ? (double)at.displacement[1] : *reference;
      peak = fmax(peak, fabs(*reference));
      worst = fmax(worst, fabs((double)at.displacement[1] - *reference));
    }
  }
  return worst / peak;
}

/* E11.8, E11.10: the stiff axial modes (the step limit of rk4 is 0.19 ms) do not set the step of the dissipative and
   the exponential scheme: 5 ms and more for 0.1 % of the peak. */
TEST(stiff_axial_modes_do_not_set_the_step)
{
  static double tip[64];
  strained_beam(3, 3.1724e7, 0.0, 1);
  strained_body(FB_BASE_PRESCRIBED, FBT_MOMENTUM);
  (void)spin_up_tip(RK4, 0.000125, 12.0, tip);
  {
    const double sdirk = spin_up_tip(SDIRK, 0.005, 12.0, tip), coarse = spin_up_tip(SDIRK, 0.01, 12.0, tip);
    const double fast = spin_up_tip(EXPONENTIAL, 0.005, 12.0, tip), longer = spin_up_tip(EXPONENTIAL, 0.02, 12.0, tip);
    fbt_figure("SDIRK2 at 5 ms, three stiff elements", "rk4 at 0.125 ms", sdirk);
    fbt_figure("exponential scheme at 5 ms, three stiff elements", "rk4 at 0.125 ms", fast);
    FBT_BELOW(sdirk, FBT_TOL(1e-4, 2e-2));
    FBT_BELOW(coarse, FBT_TOL(5e-4, 2e-2));
    FBT_BELOW(fast, FBT_TOL(1e-5, 2e-2));
    FBT_BELOW(longer, FBT_TOL(1e-3, 2e-2));
  }
}

/* E11.32: two iterations that leave more than a tenth of the first correction and a hundredth of the step's way do not
   make a step: a light, soft, fast body whose steps are long is refused, or right to a few parts in a hundred. */
TEST(implicit_steps_that_have_not_converged_say_so)
{
  int refused = 0, taken = 0;
  for (int run = 0; run < 60; run++) {
    const integrator which = run % 2 ? MIDPOINT : SDIRK;
    const double dt = 0.02 * (1 + run % 10), spin = 1.0 + run / 10;
    fb_state state, fine;
    fb_status status;
    boom(FB_EFFECTS_FULL, FB_BASE_FREE, 2, 2, 0, 0.0);
    body.allow_long_step = 1;
    fbt_seed(9);
    start(&state, 0.3, spin);
    fine = state;
    status = which == MIDPOINT ? fb_midpoint_step(&body, &state, &implicit_work, NULL, (fb_real)dt, 2)
                               : fb_sdirk_step(&body, &state, &implicit_work, NULL, NULL, (fb_real)dt, 2);
    if (status == FB_OK) {
      const fb_status more = which == MIDPOINT
                                 ? fb_midpoint_step(&body, &fine, &implicit_work, NULL, (fb_real)dt, 40)
                                 : fb_sdirk_step(&body, &fine, &implicit_work, NULL, NULL, (fb_real)dt, 40);
      FBT_INT_EQ(more, FB_OK);
      FBT_BELOW(fbt_difference(state.quat, fine.quat, 4), 0.02 * (spin * dt + 0.1));
      taken++;
    } else {
      FBT_TRUE(status == FB_ERR_CONVERGENCE || status == FB_ERR_RANGE || status == FB_ERR_NOT_FINITE);
      refused += status == FB_ERR_CONVERGENCE;
    }
  }
  FBT_TRUE(refused > 0 && taken > 0);
}

/* A boom at rest on a base that flies at 100 m/s along x and begins to turn, w = 0.4 (1 - cos t) rad/s, bends for 0.96 s:
   its modes, by fb_midpoint_step, fb_sdirk_step or 8000 steps of fb_rk4_step; the status that ends it. */
static fb_status turned_in_flight(double q[FB_MAX_MODES], integrator which, double dt, int iterations)
{
  fb_status status;
  fb_state state;
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  status = FB_OK;
  for (int k = 0; k < (int)(0.96 / dt + 0.5) && status == FB_OK; k++) {
    fb_rk4_work work;
    fb_input in[3];
    for (int i = 0; i < 3; i++) {
      const double t = (k + 0.5 * i) * dt;
      memset(&in[i], 0, sizeof in[i]);
      in[i].v[0] = FB_R(100.0);
      in[i].w[2] = (fb_real)(0.8 * sin(0.5 * t) * sin(0.5 * t));
      in[i].w_dot[2] = (fb_real)(0.4 * sin(t));
    }
    status = which == MIDPOINT ? fb_midpoint_step(&body, &state, &implicit_work, &in[1], (fb_real)dt, iterations)
             : which == SDIRK  ? fb_sdirk_step(&body, &state, &implicit_work, &in[0], &in[2], (fb_real)dt, iterations)
                               : fb_rk4_step(&body, &state, &work, &in[0], &in[1], &in[2], (fb_real)dt);
  }
  for (int a = 0; a < body.n; a++) {
    q[a] = (double)state.q[a];
  }
  return status;
}

static double apart_in_flight(const double *a, const double *b)
{
  double most = 0.0;
  for (int i = 0; i < body.n; i++) {
    most = fmax(most, fabs(a[i] - b[i]));
  }
  return most;
}

/* E11.25, E11.54: the attitude of a prescribed base is known at every stage, and no correction of it comes to the modes one
   iteration late: a fast base that begins to turn is no failure at steps of 4 to 64 ms. Two iterations are as right as
   twelve, to a thousandth of the error of the steps, which is of order 2. */
TEST(a_fast_base_that_begins_to_turn_is_no_failure)
{
  static const unsigned effects[] = {FB_EFFECTS_LINEAR, FB_EFFECTS_FULL, FB_EFFECTS_LARGE};
  for (int run = 0; run < 6; run++) {
    const integrator which = run % 2 ? MIDPOINT : SDIRK;
    double fine[FB_MAX_MODES], error[5], few[FB_MAX_MODES], many[FB_MAX_MODES];
    boom(effects[run / 2], FB_BASE_PRESCRIBED, 2, 2, 0, 0.0);
    FBT_INT_EQ(turned_in_flight(fine, RK4, 0.96 / FBT_TOL(4000, 1000), 0), FB_OK);
    for (int k = 0; k < 5; k++) {
      const double dt = 0.004 * (1 << k);
      FBT_INT_EQ(turned_in_flight(few, which, dt, 2), FB_OK);
      FBT_INT_EQ(turned_in_flight(many, which, dt, 12), FB_OK);
      error[k] = apart_in_flight(many, fine);
      FBT_BELOW(apart_in_flight(few, many), 0.001 * error[k] + FBT_TOL(0.0, 1e-4));
    }
    for (int k = 1; k < 3; k++) {
      FBT_NEAR_ABS(log2(error[k] / error[k - 1]), 2.0, FBT_TOL(0.15, 0.6));
    }
  }
}

SUITE(integrate_implicit, RUN(a_fast_base_that_begins_to_turn_is_no_failure),
      RUN(implicit_steps_that_have_not_converged_say_so), RUN(steps_may_be_a_thousand_periods_long),
      RUN(implicit_integrators_do_not_mind_drift), RUN(iterations_are_newtons),
      RUN(membrane_coordinates_make_the_strain_linear), RUN(the_tangent_is_the_derivative_of_the_forces),
      RUN(the_exponential_integrator_is_exact_for_linear_bodies), RUN(the_exponential_integrator_knows_its_functions),
      RUN(the_exponential_integrator_is_exact_for_constant_loads), RUN(stiff_axial_modes_do_not_set_the_step))
