/* >>trim and >>linear: advised steps and step limits of spectra. */
#include "analyse.h"

static fb_analyse_work work;

/* E12.6, E12.7: limits, advised steps and damping ratios follow the unit of time: modes slower by 2^20 want steps
   longer by as much, fast, slow, damped, stiff and still ones; what stands still has no damping. Without amplitudes
   they are 1. */
TEST(advised_steps_follow_the_unit_of_time)
{
  static const double re[4] = {-0.3, -40.0, 0.0, -0.02}, im[4] = {5.0, 0.0, 0.0, 0.7};
  static const fb_integrator integrator[3] = {FB_INTEGRATOR_RK4, FB_INTEGRATOR_MIDPOINT, FB_INTEGRATOR_SDIRK};
  static const double accuracy[3] = {1e-2, 1e-4, 1e-6};
  const fb_real one[4] = {1, -1, 1, 1};
  for (int k = 0; k < 9; k++) {
    double limit[3], step[3];
    for (int unit = 0; unit < 3; unit++) {
      const double t = ldexp(1.0, 20 * (unit - 1));
      memset(&spectrum, 0, sizeof spectrum);
      spectrum.n = 4;
      for (int i = 0; i < 4; i++) {
        spectrum.re[i] = (fb_real)(re[i] / t);
        spectrum.im[i] = (fb_real)(im[i] / t);
        FBT_NEAR_ABS(fb_spectrum_damping(&spectrum, i), i == 2 ? 0.0 : -re[i] / hypot(re[i], im[i]), 4.0 * EPS);
      }
      limit[unit] = fmin((double)fb_spectrum_limit(&spectrum, integrator[k % 3]) / t, 1e10);
      step[unit] =
          (double)fb_spectrum_dt(&spectrum, integrator[k % 3], NULL, (fb_real)(10.0 * t), (fb_real)accuracy[k / 3]) / t;
      FBT_NEAR_REL(limit[unit], limit[0], 8.0 * EPS);
      FBT_NEAR_REL(step[unit], step[0], 64.0 * EPS);
      FBT_TRUE(step[unit] > 0.0);
      FBT_NEAR_ABS(fb_spectrum_dt(&spectrum, integrator[k % 3], one, (fb_real)(10.0 * t), (fb_real)accuracy[k / 3]),
                   step[unit] * t, 0.0);
    }
  }
}

/* E12.7: each of T/dt steps errs by |G - exp|(i omega dt): a tolerance of their sum gives that step, short or long. */
TEST(advised_steps_are_those_whose_errors_add_up)
{
  static const fb_integrator integrator[3] = {FB_INTEGRATOR_RK4, FB_INTEGRATOR_MIDPOINT, FB_INTEGRATOR_SDIRK};
  static const double step[5] = {0.05, 0.1, 0.25, 0.5, 1.0}; /* [rad] */
  const double c = 1.0 - sqrt(0.5), omega = 4.0, T = 10.0;
  const fb_real amplitude[1] = {FB_R(3.0)};
  for (int k = 0; k < 15; k++) {
    const double d = step[k % 5], top = (1.0 - 2.0 * c) * d, low = c * d;
    const double turn[3] = {atan2(d - d * d * d / 6.0, 1.0 - d * d / 2.0 + d * d * d * d / 24.0), 2.0 * atan(0.5 * d),
                            atan(top) + 2.0 * atan(low)};
    const double size[3] = {hypot(d - d * d * d / 6.0, 1.0 - d * d / 2.0 + d * d * d * d / 24.0), 1.0,
                            sqrt(1.0 + top * top) / (1.0 + low * low)};
    const double error = hypot(size[k / 5] * cos(turn[k / 5]) - cos(d), size[k / 5] * sin(turn[k / 5]) - sin(d));
    memset(&spectrum, 0, sizeof spectrum);
    spectrum.n = 1;
    spectrum.im[0] = (fb_real)omega;
    FBT_NEAR_REL(
        fb_spectrum_dt(&spectrum, integrator[k / 5], amplitude, (fb_real)T, (fb_real)(3.0 * error * T * omega / d)),
        d / omega, 0.01);
    FBT_NEAR_REL(fb_spectrum_error(&spectrum, integrator[k / 5], amplitude, (fb_real)(d / omega), (fb_real)T),
                 3.0 * error * T * omega / d, FBT_TOL(0.02, 0.02));
  }
}

/* E12.6: at 0.99 of the limit a damped, spinning oscillator comes to rest, at 1.01 it runs away; where the limit is
   that of the real axis (2.785), of the imaginary one (2.828) and between. */
TEST(step_limits_are_those_of_the_spectrum)
{
  static const double zeta[4] = {0.0, 0.05, 0.4, 3.0};
  for (int run = 0; run < 4; run++) {
    fb_input input;
    double limit;
    particle_on_springs(0.0, 4.0, 900.0, zeta[run]);
    body.allow_long_step = 1;
    body.deflection_limit = FB_R(1e6);
    memset(&input, 0, sizeof input);
    input.w[2] = FB_R(0.5);
    for (int k = 0; k < 2; k++) {
      fb_state state;
      fb_rk4_work rk4;
      fb_status status = FB_OK;
      double after;
      FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
      FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, &spectrum, &state, &input), FB_OK);
      limit = (double)fb_spectrum_limit(&spectrum, FB_INTEGRATOR_RK4);
      state.q[1] = FB_R(1e-3);
      for (int i = 0; i < 4000 && status == FB_OK; i++) {
        status = fb_rk4_step(&body, &state, &rk4, &input, &input, &input, (fb_real)(limit * (k ? 1.01 : 0.99)));
      }
      after = fabs((double)state.q[1]) + fabs((double)state.pi[1]) / 30.0;
      FBT_TRUE(k ? status == FB_ERR_RANGE || after > 1.0 : after < 1e-3);
    }
    FBT_TRUE(fb_spectrum_limit(&spectrum, FB_INTEGRATOR_SDIRK) > FB_R(1e6));
  }
}

/* E12.6: a mode that grows, by rounding or slowly of itself, limits the step as one that just swings: at 2 sqrt 2 of
   rk4's imaginary axis; one that only grows does not. What makes no sense has no step. */
TEST(step_limits_hold_for_modes_that_grow)
{
  static const double growth[3] = {1e-12, 1e-6, 0.2};
  memset(&spectrum, 0, sizeof spectrum);
  spectrum.n = 2;
  for (int run = 0; run < 3; run++) {
    spectrum.re[0] = FB_R(5.0);
    spectrum.re[1] = (fb_real)(growth[run] * 300.0);
    spectrum.im[1] = FB_R(300.0);
    FBT_NEAR_REL(fb_spectrum_limit(&spectrum, FB_INTEGRATOR_RK4), 2.0 * sqrt(2.0) / 300.0, FBT_TOL(1e-9, 1e-3));
  }
  FBT_NEAR_ABS(fb_spectrum_limit(NULL, FB_INTEGRATOR_RK4), 0.0, 0.0);
  FBT_NEAR_ABS(fb_spectrum_limit(&spectrum, FB_INTEGRATOR_EXPONENTIAL), 0.0, 0.0);
  FBT_NEAR_ABS(fb_spectrum_damping(&spectrum, 0), -1.0, 0.0);
  FBT_NEAR_ABS(fb_spectrum_damping(&spectrum, 2), 0.0, 0.0);
  FBT_NEAR_ABS(fb_spectrum_damping(&spectrum, -1), 0.0, 0.0);
  FBT_NEAR_ABS(fb_spectrum_damping(NULL, 0), 0.0, 0.0);
  for (int imaginary = 0; imaginary < 2; imaginary++) {
    (imaginary ? spectrum.im : spectrum.re)[0] = (fb_real)NAN;
    FBT_NEAR_ABS(fb_spectrum_limit(&spectrum, FB_INTEGRATOR_RK4), 0.0, 0.0);
    FBT_NEAR_ABS(fb_spectrum_dt(&spectrum, FB_INTEGRATOR_SDIRK, NULL, FB_R(1.0), FB_R(0.1)), 0.0, 0.0);
    spectrum.re[0] = -FB_R(1.0);
  }
}

static void step_on(fb_state *state, fb_integrator integrator, const fb_input *input, double dt)
{
  static fb_rk4_work rk4;
  static fb_implicit_work implicit;
  const fb_real h = (fb_real)dt;
  FBT_INT_EQ(integrator == FB_INTEGRATOR_RK4        ? fb_rk4_step(&body, state, &rk4, input, input, input, h)
             : integrator == FB_INTEGRATOR_MIDPOINT ? fb_midpoint_step(&body, state, &implicit, input, h, 0)
                                                    : fb_sdirk_step(&body, state, &implicit, input, input, h, 0),
             FB_OK);
}

/* Largest error of the oscillator's two coordinates together, of sizes 1 and 0.3 to begin with, over that many steps:
   against the exact motion (its modes at rest). */
static double oscillator_error(fb_integrator integrator, double zeta, double dt, int steps)
{
  fb_state state;
  fb_input input;
  double most = 0.0;
  memset(&input, 0, sizeof input);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  state.q[0] = FB_R(1.0);
  state.q[1] = FB_R(0.3);
  for (int i = 1; i <= steps; i++) {
    double error = 0.0;
    step_on(&state, integrator, &input, dt);
    for (int a = 0; a < 2; a++) {
      const double omega = sqrt(a ? 90.0 : 4.0), decay = zeta * omega, own = omega * sqrt(1.0 - zeta * zeta);
      const double t = i * dt, size = a ? 0.3 : 1.0;
      const double q = size * exp(-decay * t) * (cos(own * t) + decay / own * sin(own * t));
      error += fabs((double)state.q[a] - q);
    }
    most = fmax(most, error);
  }
  return most;
}

/* The step advised for that motion. */
static double advised_step(fb_integrator integrator, double zeta, double duration, double tolerance)
{
  const fb_real amplitude[4] = {FB_R(1.0), FB_R(0.3), 0, 0};
  fb_state state;
  fb_input input;
  particle_on_springs(0.0, 4.0, 90.0, zeta);
  body.allow_long_step = 1;
  memset(&input, 0, sizeof input);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, &spectrum, &state, &input), FB_OK);
  return (double)fb_spectrum_dt(&spectrum, integrator, amplitude, (fb_real)duration, (fb_real)tolerance);
}

/* E12.7: steps by the advice miss a swinging oscillator's exact motion by what was wanted, within a factor of 3. */
TEST(advised_steps_err_as_wanted)
{
  static const double wanted[3] = {1e-1, 1e-2, 1e-3};
  for (int run = 0; run < 18; run++) {
    const fb_integrator integrator = (fb_integrator)(run % 3);
    const double zeta = run / 3 % 2 ? 0.02 : 0.0, duration = 20.0, tolerance = wanted[run / 6];
    const double dt = advised_step(integrator, zeta, duration, tolerance);
    double error;
    FBT_TRUE(dt > 0.0);
    error = oscillator_error(integrator, zeta, dt, (int)ceil(duration / dt));
    FBT_BELOW(error, 3.0 * tolerance);
    FBT_BELOW(tolerance / 3.0, error);
  }
  FBT_NEAR_ABS(fb_spectrum_dt(&spectrum, FB_INTEGRATOR_COUNT, NULL, FB_R(1.0), FB_R(0.1)), 0.0, 0.0);
  FBT_NEAR_ABS(fb_spectrum_dt(&spectrum, FB_INTEGRATOR_RK4, NULL, FB_R(0.0), FB_R(0.1)), 0.0, 0.0);
  FBT_NEAR_ABS(fb_spectrum_dt(&spectrum, FB_INTEGRATOR_RK4, NULL, FB_R(1.0), (fb_real)NAN), 0.0, 0.0);
}

/* E12.7: over a time that outlasts the motion by far the advised steps still resolve it while it lasts: they do not
   grow with the duration, and err in the first seconds by what was wanted. */
TEST(advice_resolves_modes_that_die_out)
{
  for (int run = 0; run < 6; run++) {
    const fb_integrator integrator = (fb_integrator)(run % 3);
    const double zeta = 0.3, tolerance = run / 3 ? 1e-2 : 1e-1;
    const double dt = advised_step(integrator, zeta, 1e6, tolerance);
    double error;
    FBT_NEAR_REL(dt, advised_step(integrator, zeta, 1e2, tolerance), FBT_TOL(1e-9, 1e-4));
    FBT_BELOW(dt, 1.0);
    error = oscillator_error(integrator, zeta, dt, (int)ceil(20.0 / dt));
    FBT_BELOW(error, 3.0 * tolerance);
    FBT_BELOW(tolerance / 3.0, error);
  }
}

/* E12.7: the fastest mode of a stiff spring with a stiff dashpot, exp(l t) with l = -9899/s, has gone before a step of
   the implicit integrators ends: what is left of it then counts (the midpoint rule turns its sign and keeps nearly
   all). The advice holds what is wanted, and where it is less than all of the duration, by no more than a factor of
   5. */
TEST(advised_steps_bear_stiff_damping)
{
  for (int run = 0; run < 9; run++) {
    const fb_integrator integrator = (fb_integrator)(run % 3);
    const double rate = -1e3 * (5.0 + sqrt(24.0)), wanted[3] = {0.2, 3e-2, 3e-3}, tolerance = wanted[run / 3];
    const double duration = 0.05;
    const fb_real amplitude[4] = {0, 0, 0, FB_R(1e-3)};
    fb_state state;
    fb_input input;
    double dt, most = 0.0;
    particle_on_springs(0.0, 4.0, 1e6, 5.0);
    body.allow_long_step = 1;
    memset(&input, 0, sizeof input);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, &spectrum, &state, &input), FB_OK);
    FBT_INT_EQ(spectrum.n, 4);
    FBT_NEAR_REL(spectrum.re[3], rate, FBT_TOL(1e-8, 1e-2));
    dt = (double)fb_spectrum_dt(&spectrum, integrator, amplitude, (fb_real)duration, (fb_real)(1e-3 * tolerance));
    FBT_TRUE(dt > 0.0);
    state.q[1] = FB_R(1e-3);
    state.pi[1] = (fb_real)(1e-3 * rate);
    for (int i = 1; i <= (int)ceil(duration / dt); i++) {
      step_on(&state, integrator, &input, dt);
      most = fmax(most, fabs(1e3 * (double)state.q[1] - exp(rate * i * dt)));
    }
    FBT_BELOW(most, 3.0 * tolerance);
    FBT_TRUE(dt > 0.99 * duration || most > tolerance / 5.0);
  }
}

SUITE(analyse_steps, RUN(advised_steps_follow_the_unit_of_time), RUN(step_limits_are_those_of_the_spectrum),
      RUN(step_limits_hold_for_modes_that_grow), RUN(advised_steps_err_as_wanted),
      RUN(advised_steps_are_those_whose_errors_add_up), RUN(advised_steps_bear_stiff_damping),
      RUN(advice_resolves_modes_that_die_out))
