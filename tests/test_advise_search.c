/* >>advise: the search for the cheapest model by simulation; what is refused. */
#include "advise.h"

static fb_shape other;
static fb_body body, twin;
static fb_body_work body_work;

/* Largest step of the integrator that is advised, of the body that is advised. */
static double limit_of_advice(void)
{
  const fb_real spin = (fb_real)sqrt((double)fb_vec3_dot(envelope.spin, envelope.spin));
  const fb_real *const a = envelope.acceleration;
  const fb_real most = level.base == FB_BASE_FREE ? FB_R(0.0) : (fb_real)sqrt((double)fb_vec3_dot(a, a));
  fb_body_desc desc = level;
  desc.effects = advice.effects;
  for (int k = 0; k < advice.n; k++) {
    desc.zeta[k] = level.zeta[advice.coordinate[k]];
  }
  FBT_INT_EQ(fb_shape_select(&other, &shape, advice.coordinate, advice.n), FB_OK);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &other, &desc), FB_OK);
  return (double)(advice.integrator == FB_INTEGRATOR_RK4           ? fb_rk4_limit(&body, spin, most)
                  : advice.integrator == FB_INTEGRATOR_EXPONENTIAL ? fb_exponential_limit(&body, spin, most)
                                                                   : fb_implicit_limit(&body, spin, most));
}

/* E13.15: however much may be missed, a step is within the limit of its integrator. */
TEST(advised_steps_are_within_the_limit)
{
  const fb_real center[3] = {0, 0, 0}, inertia[6] = {5, 5, 5, 0, 0, 0};
  for (int k = 0; k < 8; k++) {
    boom_under_a_force(0.5, 2, 2);
    envelope.spin[k < 6 ? k % 2 : 1] = k < 4 || k > 5 ? FB_R(2.0) : FB_R(0.0);
    envelope.acceleration[0] = k < 6 ? FB_R(0.0) : -FB_R(300.0); /* pulls it straight; gravity on what is free */
    FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(20.0), center, inertia), FB_OK);
    level.base = k == 7 ? FB_BASE_FREE : FB_BASE_PRESCRIBED;
    envelope.duration = k % 3 == 0 ? FB_R(2.0) : FB_R(50.0);
    level.effects |= (unsigned)FB_EFFECT_DAMPING;
    level.zeta[0] = k == 1 || k > 4 ? FB_R(3.0) : FB_R(0.01); /* heavy, along the force */
    FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(3.0)), FB_OK);
    FBT_TRUE((advice.effects & FB_EFFECT_DAMPING) != 0);
    if (k == 1 || k > 5) { /* as long as that allows, with accelerations, too */
      FBT_NEAR_REL(advice.dt, limit_of_advice(), FBT_TOL(1e-9, 1e-5));
    }
  }
}

/* E12.7 of the mode, with the share of it that swings (E13.43), and of the drive f, with E13.44, give the step, up to
   the integrator's limit and an eighth of the duration; of the exponential scheme as rk4, of the part of the forces that
   the linear set lacks, as far as that matters. */
TEST(advised_steps_are_those_of_the_spectrum)
{
  static fb_spectrum spectrum;
  const double tolerance[3] = {2.0, 1e-3, 1e-5};
  int exponential = 0;
  for (int run = 0; run < 18; run++) { /* one mode, one in either plane */
    const int k = run % 9;
    const fb_real f = k < 6 ? FB_R(1.0) : FB_R(20.0), s = k < 3 ? FB_R(0.05) : FB_R(0.5);
    fb_real amplitude[3], drive;
    double dt;
    boom_under_a_force(0.5, run / 9, 1);
    envelope.frequency = f;
    envelope.spin[0] = s;
    FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, (fb_real)tolerance[k % 3]), FB_OK);
    exponential += advice.integrator == FB_INTEGRATOR_EXPONENTIAL;
    const fb_integrator integrator =
        advice.integrator == FB_INTEGRATOR_EXPONENTIAL ? FB_INTEGRATOR_RK4 : advice.integrator;
    drive = advice.integrator == FB_INTEGRATOR_EXPONENTIAL ? work.linear_off : FB_R(1.0);
    spectrum.n = advice.n + 1;
    for (int m = 0; m < advice.n; m++) {
      const fb_real swing = drive * work.swing[advice.n - 1][m] / work.deflection;
      const int matters =
          advice.integrator != FB_INTEGRATOR_EXPONENTIAL || swing > FB_R(0.1) * advice.error_step / (fb_real)advice.n;
      amplitude[m] = matters ? swing : FB_R(0.0);
      spectrum.im[m] = matters ? work.omega[advice.n - 1][m] + s : FB_R(0.0);
    }
    amplitude[advice.n] = FB_R(1.0);
    spectrum.im[advice.n] = f;
    dt = 0.0;
    for (double high = fmin(1.25, limit_of_advice()), next = high; high - dt > 1e-6 * high;
         next = 0.5 * (dt + high)) { /* what the end of the drive leaves to the rest */
      double kink = 0.0, left;
      for (int m = 0; m < advice.n; m++) {
        const double turn = (double)work.omega[advice.n - 1][m] * next, swing = (double)work.swing[advice.n - 1][m];
        const int of_two = advice.integrator == FB_INTEGRATOR_MIDPOINT || advice.integrator == FB_INTEGRATOR_SDIRK;
        kink = hypot(kink, fmin(2.0, turn * turn / (of_two ? 8.0 : 24.0)) * swing / (double)work.deflection);
      }
      left = (double)advice.error_step * 1.0001 - kink;
      left =
          left > 0.0 ? (double)fb_spectrum_dt(&spectrum, integrator, amplitude, envelope.duration, (fb_real)left) : 0.0;
      dt = next <= left ? next : dt;
      high = next <= left ? high : next;
      if (dt == high) {
        break;
      }
    }
    FBT_NEAR_REL(advice.dt, dt, 0.03);
    FBT_NEAR_REL(work.omega[advice.n - 1][0] * work.omega[advice.n - 1][0], shape.K[0], 0.05);
  }
  FBT_TRUE(exponential > 0);
}

/* E13.14: what is slow takes an implicit integrator, which has no limit; what swings rk4, or the exponential scheme
   where it is nearly linear. */
TEST(integrators_have_their_scenes)
{
  const fb_integrator expected[3] = {FB_INTEGRATOR_MIDPOINT, FB_INTEGRATOR_RK4, FB_INTEGRATOR_EXPONENTIAL};
  for (int k = 0; k < 3; k++) {
    boom_under_a_force(0.5, 0, 1);
    envelope.frequency = k == 2 ? FB_HUGE : k ? FB_R(20.0) : FB_R(0.0);
    envelope.spin[0] = k == 1 ? FB_R(2.0) : FB_R(0.0);
    (void)deflection();
    FBT_INT_EQ(advice.integrator, expected[k]);
  }
}

/* E13.14: what is advised adds up to the tolerance, and its step to the frame, also of one longer than the scene. */
TEST(errors_and_steps_add_up)
{
  const fb_real frame[4] = {FB_R(0.0), FB_R(1e-4), FB_R(0.25), FB_R(25.0)};
  for (int k = 0; k < 4; k++) {
    const double tolerance[2] = {0.03, 0.003};
    for (int j = 0; j < 2; j++) {
      double parts;
      boom_under_a_force(0.2, 1, 3);
      envelope.frequency = FB_R(20.0);
      envelope.spin[1] = FB_R(0.5);
      envelope.frame = frame[k];
      FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, (fb_real)tolerance[j]), FB_OK);
      FBT_BELOW(advice.error, tolerance[j] * (1.0 + 1e-5));
      FBT_NEAR_REL(advice.error, advice.error_effects + advice.error_modes + advice.error_step + advice.error_model,
                   1e-5);
      FBT_TRUE(advice.dt > FB_R(0.0) && advice.dt <= FB_R(1.00001) * envelope.duration);
      parts = (double)(frame[k] / advice.dt);
      FBT_NEAR_ABS(parts, floor(parts + 0.5), FBT_TOL(1e-9, 1e-2));
      FBT_TRUE(k == 0 || parts > 0.5);
      FBT_INT_EQ(advice.long_step, 0);
    }
  }
}

/* Interface: a step is the longest part of the frame that is no longer than what it would be without a frame. */
TEST(steps_are_the_longest_parts_of_a_frame)
{
  const double ratio[9] = {0.4, 1.02, 1.6, 1.98, 2.0, 2.5, 4.0, 7.01, 1000.5};
  fb_advice any;
  boom_under_a_force(0.02, 0, 1);
  envelope.frequency = FB_R(20.0);
  (void)deflection();
  any = advice;
  for (int k = 0; k < 9; k++) {
    const double frame = ratio[k] * (double)any.dt;
    envelope.frame = (fb_real)ratio[k] * any.dt;
    (void)deflection();
    FBT_INT_EQ(advice.integrator, any.integrator);
    FBT_NEAR_REL(advice.dt, frame / ceil(ratio[k]), FBT_TOL(1e-12, 1e-5));
  }
}

/* E13.14: the cheapest whose errors add up to the tolerance, though they leave little of it to the step: under a steady
   force one mode, which lacks 1 - 0.9707, as soon as that may be missed. */
TEST(advice_is_the_cheapest_that_adds_up)
{
  for (int k = 0; k < 4; k++) {
    const double part[4] = {0.98, 1.02, 1.15, 1.3}; /* of what four fifths of the tolerance are */
    boom_under_a_force(1e-3, 0, 6);
    FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, (fb_real)((1.0 - 0.9707) * part[k] / 0.8)),
               FB_OK);
    FBT_INT_EQ(advice.n == 1, k > 0);
    FBT_INT_EQ(advice.effects, FB_EFFECTS_LINEAR);
  }
}

/* E13.44: an oscillator in steps of rk4, driven by a sine of half its frequency that ends in the middle of a step, is
   left with an error of (omega h)^2/24 of the free vibration, r of the static answer. */
TEST(drives_may_end_within_a_step)
{
  const double f = 0.5, h = 0.2, end = 2.0 * 3.14159265358979 / f;
  const int steps = (int)(end / h);
  double t = end - (steps + 0.5) * h, y[2] = {0.0, 0.0}, exact[2] = {0.0, 0.0};
  for (int k = 0; k < 2;
       k++) { /* of sin(f t) from rest: (sin(f t) - f sin t)/(1 - f^2), at the first step and the last */
    double *const at = k ? exact : y;
    at[0] = (sin(f * (k ? end : t)) - f * sin(k ? end : t)) / (1 - f * f);
    at[1] = f * (cos(f * (k ? end : t)) - cos(k ? end : t)) / (1 - f * f);
  }
  for (int k = 0; k <= steps; k++, t += h) {
    double rate[4][2];
    for (int s = 0; s < 4; s++) {
      const double part = s == 0 ? 0.0 : s < 3 ? 0.5 * h : h, now = t + part;
      const double x = y[0] + (s ? part * rate[s - 1][0] : 0.0), v = y[1] + (s ? part * rate[s - 1][1] : 0.0);
      rate[s][0] = v;
      rate[s][1] = (now < end * (1 - 1e-12) ? sin(f * now) : 0.0) - x;
    }
    for (int i = 0; i < 2; i++) {
      y[i] += h / 6 * (rate[0][i] + 2 * rate[1][i] + 2 * rate[2][i] + rate[3][i]);
    }
  }
  { /* half a step of free vibration */
    const double c = cos(0.5 * h), s = sin(0.5 * h), x = c * exact[0] + s * exact[1], v = c * exact[1] - s * exact[0];
    FBT_NEAR_REL(hypot(y[0] - x, y[1] - v), f * h * h / 24.0, 0.2);
  }
}

/* Largest error of an oscillator in steps dt of rk4 under a load of which the static answer is 1, taken away at `ends`. */
static double error_of_a_pulse(double omega, double dt, double ends, double duration)
{
  double y[2] = {0.0, 0.0}, worst = 0.0;
  for (int k = 1; k * dt <= duration; k++) {
    const double t = (k - 1) * dt, now = k * dt, after = fmax(0.0, now - ends);
    double rate[4][2];
    for (int s = 0; s < 4; s++) {
      const double part = s == 0 ? 0.0 : s < 3 ? 0.5 * dt : dt;
      const double at = s == 0 ? t + 1e-9 : s < 3 ? t + part : now - 1e-9; /* of a load that jumps between steps */
      rate[s][0] = y[1] + (s ? part * rate[s - 1][1] : 0.0);
      rate[s][1] = omega * omega * ((at < ends) - y[0] - (s ? part * rate[s - 1][0] : 0.0));
    }
    for (int i = 0; i < 2; i++) {
      y[i] += dt / 6 * (rate[0][i] + 2 * rate[1][i] + 2 * rate[2][i] + rate[3][i]);
    }
    worst = fmax(worst, fabs(y[0] - (after > 0.0 ? cos(omega * after) : 1.0) + cos(omega * now)));
  }
  return worst;
}

/* E13.44: a step load that is taken away within a step, wherever that is, errs by no more than the advice says; where
   steps meet it shortens none. */
TEST(loads_may_be_taken_away_within_a_step)
{
  double dt = 0.0;
  for (int k = 0; k < 12; k++) {
    const double tolerance = k < 6 ? 0.1 : 0.02;
    double omega, swing, worst = 0.0;
    boom_under_a_force(1e-3, 0, 1);
    envelope.frequency = FB_HUGE;
    envelope.frame = k % 6 < 3 ? FB_R(0.0) : FB_R(0.25);
    envelope.lasts = k % 3 == 0 ? FB_R(0.0) : k % 3 == 1 ? FB_R(4.0) : FB_R(4.0321);
    FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, (fb_real)tolerance), FB_OK);
    omega = (double)work.omega[advice.n - 1][0];
    swing = (double)(work.swing[advice.n - 1][0] / work.deflection);
    if (k % 3 == 0 || k % 6 == 4) {
      FBT_TRUE(k % 3 == 0 || (double)advice.dt == dt);
      dt = (double)advice.dt;
      continue;
    }
    FBT_TRUE(omega * (double)advice.dt / 3.0 * swing < tolerance);
    FBT_INT_EQ(advice.integrator, FB_INTEGRATOR_RK4);
    for (int i = 0; i < 20; i++) {
      const double ends = (double)envelope.lasts + (envelope.frame > FB_R(0.0) ? 0.0 : 0.05 * i * (double)advice.dt);
      worst = fmax(worst, swing * error_of_a_pulse(omega, (double)advice.dt, ends, 10.0));
    }
    FBT_TRUE(worst < tolerance);
    FBT_TRUE(k % 3 == 2 || worst > 0.3 * tolerance);
  }
}

/* What an oscillator of frequency 1 errs by in a step of `turn` from rest if its drive ends at the part `at` of it with a
   slope of 1 (or a curvature): the drive replaced by the parabola through it at the start, the middle and the end,
   against the drive itself, by leapfrog. */
static double end_error(double turn, double at, int smooth)
{
  const double h = turn / 400;
  double past[3], x = 0.0, v = 0.0;
  for (int i = 0; i < 3; i++) {
    past[i] = fmax(0.0, turn * (0.5 * i - at));
    past[i] = smooth ? 0.5 * past[i] * past[i] : past[i];
  }
  for (int n = 0; n < 400; n++) {
    const double u = (n + 0.5) / 400, now = fmax(0.0, turn * (u - at)), drive = smooth ? 0.5 * now * now : now;
    x += 0.5 * h * v;
    v += h * (4 * u * (1 - u) * past[1] + u * (2 * u - 1) * past[2] - drive - x);
    x += 0.5 * h * v;
  }
  return hypot(x, v);
}

/* E13.44: where it is not known when the drive ends, what is advised covers the worst place in a step, by brute force. */
TEST(unknown_ends_are_met_at_their_worst)
{
  double nearest[2] = {0.0, 0.0};
  for (int run = 0; run < 24; run++) {
    const int smooth = run % 2;
    double worst = 0.0;
    make_two_booms(4, 0);
    envelope.frequency = FB_R(1.5);
    envelope.duration = FB_R(20.0);
    envelope.smooth = smooth;
    envelope.load[0].torque[2] = FB_R(1.0);
    FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope,
                               (fb_real)(0.05 * pow(smooth ? FBT_TOL(0.1, 0.5) : 0.7, run / 2))),
               FB_OK);
    for (int i = 0; i < 60; i++) {
      double kink = 0.0;
      for (int m = 0; m < advice.n; m++) {
        const double by = end_error((double)(work.omega[advice.n - 1][m] * advice.dt), i / 60.0, smooth);
        kink = hypot(kink, by * (double)(work.swing[advice.n - 1][m] / work.deflection));
      }
      worst = fmax(worst, kink);
    }
    FBT_BELOW(worst, 1.001 * (double)advice.error_step);
    nearest[smooth] = fmax(nearest[smooth], worst / (double)advice.error_step);
  }
  FBT_BELOW(0.9, nearest[0]);
  FBT_BELOW(FBT_TOL(0.95, 0.2), nearest[1]);
}

/* E13.44: where it is known when the drive ends, a step is the longest part of the frame that meets that end well enough,
   by brute force; if it ends between frames, a shorter one than if it ends with one. */
TEST(known_ends_are_met_by_steps)
{
  static fb_spectrum spectrum;
  int count[2] = {0, 0};
  for (int run = 0; run < 160; run += FBT_SHORT ? 3 : 1) {
    const double lasts[4] = {8.0, 8.05, 8.09, 8.123}, frame = 0.25;
    const int smooth = run / 4 % 2;
    fb_real amplitude[FB_MAX_MODES];
    double dt = 0.0;
    int exponential, parts;
    make_two_booms(4, 0);
    envelope.frequency = FB_R(1.5);
    envelope.duration = FB_R(20.0);
    envelope.frame = (fb_real)frame;
    envelope.smooth = smooth;
    envelope.load[0].torque[2] = FB_R(1.0);
    envelope.lasts = (fb_real)lasts[run % 4];
    FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, (fb_real)(0.1 * pow(0.8, run / 8))), FB_OK);
    exponential = advice.integrator == FB_INTEGRATOR_EXPONENTIAL;
    count[exponential]++;
    FBT_TRUE(exponential || advice.integrator == FB_INTEGRATOR_RK4);
    spectrum.n = 0;
    for (int m = 0; m < advice.n; m++) {
      const fb_real swing = work.swing[advice.n - 1][m] / work.deflection * (exponential ? work.linear_off : FB_R(1.0));
      if (!exponential || swing > FB_R(0.1) * advice.error_step / (fb_real)advice.n) {
        amplitude[spectrum.n] = swing;
        spectrum.im[spectrum.n++] = work.omega[advice.n - 1][m];
      }
    }
    amplitude[spectrum.n] = FB_R(1.0);
    spectrum.im[spectrum.n++] = envelope.frequency;
    for (parts = (int)ceil(frame / limit_of_advice() - 1e-5); parts < 100; parts++) {
      double kink = 0.0, left;
      dt = frame / parts;
      for (int m = 0; m < advice.n; m++) {
        const double at = lasts[run % 4] / dt - floor(lasts[run % 4] / dt + 1e-5);
        const double by = end_error((double)work.omega[advice.n - 1][m] * dt, fmax(at, 0.0), smooth);
        kink = hypot(kink, fmin(2.0, by) * (double)(work.swing[advice.n - 1][m] / work.deflection));
      }
      left = (double)advice.error_step * 1.0001 - kink;
      if (left > 0.0 && dt <= 1.0001 * (double)fb_spectrum_dt(&spectrum, FB_INTEGRATOR_RK4, amplitude,
                                                              envelope.duration, (fb_real)left)) {
        break;
      }
    }
    FBT_NEAR_REL(advice.dt, dt, 1e-5);
  }
  FBT_TRUE(count[0] > (FBT_SHORT ? 8 : 30) && count[1] > (FBT_SHORT ? 8 : 30));
}

/* E13.43: below its frequency a sine leaves r/(1 - r^2) of the static answer as free vibration, (1 - cos)/2 half of
   r^2/(1 - r^2), a jump all of it: what solves x'' + omega^2 (x - g) = 0 from rest, less the driven part. */
TEST(drives_leave_free_vibrations_behind)
{
  for (int k = 0; k < 4; k++) {
    const double r = 0.3, driven = 1.0 / (1.0 - r * r);
    double x = 0.0, v = 0.0, t = 0.0, left;
    boom_under_a_force(0.5, 0, 1);
    envelope.smooth = k & 1;
    envelope.frequency = k < 2 ? (fb_real)(r * sqrt((double)shape.K[0])) : FB_HUGE;
    (void)deflection();
    for (const double h = 1e-3; t < 10.0; t += h) { /* omega = 1; leapfrog */
      const double middle = t + 0.5 * h, g = k > 1 ? 1.0 : k ? 0.5 * (1 - cos(r * middle)) : sin(r * middle);
      x += 0.5 * h * v;
      v += h * (g - x);
      x += 0.5 * h * v;
    }
    x -= k > 1 ? 1.0 : k ? 0.5 - 0.5 * driven * cos(r * t) : driven * sin(r * t);
    v -= k > 1 ? 0.0 : k ? 0.5 * driven * r * sin(r * t) : driven * r * cos(r * t);
    left = hypot(x, v);
    FBT_NEAR_REL((double)work.swing[0][0] / (double)work.most[0][0] * (k < 2 ? driven : 2.0), left, 0.01);
  }
}

#if FB_WITH_LARGE_DEFLECTION
/* The boom under a force that jumps: tip by tip, with steps that are within their limits; a failure ends the test. */
static void drop(fb_real *out, int count)
{
  static fb_exponential exponential;
  static fb_exponential_work exponential_work;
  static fb_rk4_work rk4_work;
  fb_state state;
  fb_input input;
  fb_motion motion;
  fb_node_motion tip;
  const int is_exponential = advice.integrator == FB_INTEGRATOR_EXPONENTIAL;
  fb_body_desc desc = level;
  desc.effects = advice.effects;
  memset(&input, 0, sizeof input);
  memset(&motion, 0, sizeof motion);
  input.n_load = 1;
  input.load[0] = envelope.load[0];
  FBT_INT_EQ(fb_shape_select(&other, &shape, advice.coordinate, advice.n), FB_OK);
  FBT_INT_EQ(fb_body_init(&twin, &body_work, &other, &desc), FB_OK);
  FBT_INT_EQ(fb_state_init(&twin, &state), FB_OK);
  FBT_INT_EQ(fb_exponential_init(&exponential, &body_work, &twin, advice.dt), FB_OK);
  for (int k = 0; k < count; k++) {
    FBT_INT_EQ(is_exponential
                   ? fb_exponential_step(&twin, &exponential, &state, &exponential_work, &input, &input, &input)
                   : fb_rk4_step(&twin, &state, &rk4_work, &input, &input, &input, advice.dt),
               FB_OK);
    FBT_INT_EQ(fb_body_node_motion_eval(&twin, &tip, &state, &motion, 1), FB_OK);
    out[k] = tip.displacement[2];
  }
}
#endif

/* E13.41, E13.42: steps of the exponential scheme that are advised with large deflection are taken, and as many points
   as are advised move the tip as the default does. */
TEST(advised_steps_and_points_are_enough)
{
#if FB_WITH_LARGE_DEFLECTION
  static fb_real fine[400], coarse[400];
  int exponential = 0;
  for (int k = 0; k < 7; k++) {
    const double bend[4] = {0.1, 0.2, 0.35, 0.1};
    const double tolerance = k == 6 ? 3e-2 : k % 2 ? 1e-3 : 1e-2; /* the last step by its limit, not its error */
    const int count = 100, n = k == 6 ? 1 : 5;
    boom_under_a_force(bend[k / 2] * 0.5 * 3.0 * 500.0 / 9.0, 0, n);
    envelope.frequency = FB_HUGE;
    FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, (fb_real)tolerance), FB_OK);
    FBT_INT_EQ(advice.effects, FB_EFFECTS_LARGE);
    exponential += advice.integrator == FB_INTEGRATOR_EXPONENTIAL;
    FBT_INT_EQ(advice.line_points, advice.n + 3);
    drop(fine, count);
    boom_points = advice.line_points;
    boom_under_a_force(bend[k / 2] * 0.5 * 3.0 * 500.0 / 9.0, 0, n);
    boom_points = 0;
    drop(coarse, count);
    FBT_BELOW(fbt_difference(fine, coarse, count), 0.2 * tolerance * fbt_largest(fine, count));
  }
  FBT_TRUE(exponential > 0);
#endif
}

/* ---- search */

#define SETS (2 * ((int)FB_EFFECTS_FULL + 1))

typedef struct looked_at { /* a scene of which everything is known */
  int n_run, diverges;
  fb_real last_cost, floor, most, shortest; /* the first run's cost and step */
  int in_order;
  fb_real dt[SETS][FB_MAX_MODES + 1][FB_INTEGRATOR_COUNT]; /* last tried, by set, modes and integrator */
} looked_at;

/* Place of a set of effects in tables of all. */
static int place_of(unsigned effects)
{
  return (int)(effects & FB_EFFECTS_FULL) + (effects & FB_EFFECT_LARGE_DEFLECTION ? SETS / 2 : 0);
}

/* Off by 0.2 without spin stiffening, by 0.05 without the second mode, by the square of the step; `floor` or twice that
   at least. */
static fb_status look_at(void *user, fb_real *out, const fb_advice *candidate)
{
  looked_at *const seen = (looked_at *)user;
  const int reference = seen->n_run++ == 0;
  const fb_real dt = candidate->dt;
  FBT_TRUE(candidate->n >= 1 && candidate->n <= shape.n && dt > FB_R(0.0));
  if (reference) {
    FBT_TRUE((candidate->effects & FB_EFFECTS_FULL) == FB_EFFECTS_FULL && candidate->n == shape.n);
    seen->most = candidate->cost;
    seen->shortest = dt;
  } else {
    seen->in_order &= candidate->cost >= seen->last_cost && candidate->cost <= seen->most;
    seen->last_cost = candidate->cost;
    fb_real *const last = &seen->dt[place_of(candidate->effects)][candidate->n][candidate->integrator];
    FBT_TRUE(!(*last > FB_R(0.0)) ||
             (dt < FB_R(0.99) * *last && dt > FB_R(0.49) * *last)); /* none twice, none left out */
    *last = dt;
  }
  out[0] = FB_R(1.0);
  out[1] = reference ? FB_R(0.0) : (fb_real)(1 + seen->n_run % 2) * seen->floor + FB_R(20.0) * dt * dt;
  out[1] += candidate->effects & FB_EFFECT_SPIN_STIFFENING ? FB_R(0.0) : FB_R(0.2);
  out[1] += candidate->n >= 2 ? FB_R(0.0) : FB_R(0.05);
  return seen->diverges && !reference && candidate->integrator == FB_INTEGRATOR_RK4 ? FB_ERR_RANGE : FB_OK;
}

/* Interface: the search goes through candidates by their cost, and stops at the first that will do. */
TEST(search_stops_at_the_cheapest_that_will_do)
{
  for (int diverges = 0; diverges < 2; diverges++) {
    fb_real output[2], reference[2];
    looked_at seen;
    fb_trial trial;
    memset(&seen, 0, sizeof seen);
    memset(&trial, 0, sizeof trial);
    seen.in_order = 1;
    seen.diverges = diverges;
    trial.run = look_at;
    trial.user = &seen;
    trial.n = trial.width = 2;
    trial.output = output;
    trial.reference = reference;
    boom_under_a_force(0.5, 1, 3);
    envelope.spin[2] = FB_R(3.0);
    FBT_INT_EQ(fb_advice_search(&advice, &work, &shape, &level, &envelope, FB_R(0.01), &trial), FB_OK);
    FBT_TRUE(seen.in_order);
    FBT_INT_EQ(advice.n_trial, seen.n_run);
    FBT_INT_EQ(advice.n, 2);
    FBT_INT_EQ(advice.effects, FB_EFFECTS_LINEAR | FB_EFFECT_SPIN_STIFFENING);
    FBT_NEAR_REL(advice.error, 20.0 * (double)(advice.dt * advice.dt), FBT_TOL(1e-9, 1e-3));
    FBT_BELOW(advice.error, 0.01);
    FBT_TRUE(!diverges || advice.integrator != FB_INTEGRATOR_RK4);
    FBT_INT_EQ(advice.long_step, (double)advice.dt > limit_of_advice());
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
    FBT_NEAR_REL(seen.shortest, 0.25 * (double)fb_rk4_limit(&body, FB_R(3.0), 0), 1e-3);
    memset(&seen, 0, sizeof seen); /* what no candidate can: */
    seen.in_order = 1;
    seen.floor = FB_R(0.02);
    advice.n = -7;
    FBT_INT_EQ(fb_advice_search(&advice, &work, &shape, &level, &envelope, FB_R(0.01), &trial), FB_ERR_CONVERGENCE);
    FBT_INT_EQ(advice.n, -7);
    FBT_TRUE(seen.in_order);
    FBT_BELOW(seen.n_run, 2000);
    memset(seen.dt, 0, sizeof seen.dt);
    seen.n_run = 1; /* a reference that even the fullest misses */
    trial.has_reference = 1;
    FBT_INT_EQ(fb_advice_search(&advice, &work, &shape, &level, &envelope, FB_R(0.01), &trial), FB_ERR_CONVERGENCE);
    FBT_INT_EQ(seen.n_run, 2);
  }
}

/* Interface: parts of the frame are tried once each, and none is passed over, though rk4's longest step differs from
   set to set. */
TEST(search_tries_each_part_of_a_frame_once)
{
  for (int k = 0; k < 6; k++) {
    fb_real output[2], reference[2];
    looked_at seen;
    fb_trial trial;
    memset(&seen, 0, sizeof seen);
    memset(&trial, 0, sizeof trial);
    trial.run = look_at;
    trial.user = &seen;
    trial.n = trial.width = 2;
    trial.output = output;
    trial.reference = reference;
    seen.in_order = 1;
    seen.floor = FB_R(0.02);
    boom_under_a_force(0.5, 1, 3);
    envelope.spin[2] = FB_R(30.0);
    envelope.frame = FB_R(0.02) * (fb_real)(k + 1);
    FBT_INT_EQ(fb_advice_search(&advice, &work, &shape, &level, &envelope, FB_R(0.01), &trial), FB_ERR_CONVERGENCE);
    FBT_TRUE(seen.in_order);
    FBT_TRUE(seen.n_run > 10);
  }
}

typedef struct picky { /* takes one kind of candidate alone: effects, modes, integrator, steps up to the longest */
  unsigned effects;
  int n, integrator;
  fb_real longest, miss[4]; /* what all others are off by, by integrator */
  int n_run;
  fb_advice first;
  int tries[SETS][FB_MAX_MODES + 1][4];
  unsigned parts; /* of the frame that the steps are of the cheapest body by the midpoint rule: 1 << number */
} picky;

static fb_status pick(void *user, fb_real *out, const fb_advice *candidate)
{
  picky *const p = (picky *)user;
  const int integrator = (int)candidate->integrator;
  const unsigned effects = candidate->effects & FB_EFFECTS_LARGE;
  out[0] = FB_R(1.0);
  if (p->n_run++ == 0) {
    p->first = *candidate;
    return FB_OK;
  }
  p->tries[place_of(effects)][candidate->n][integrator]++;
  if (effects == FB_EFFECTS_LINEAR && candidate->n == 1 && integrator == (int)FB_INTEGRATOR_MIDPOINT) {
    const long parts = lround((double)(envelope.frame / candidate->dt));
    p->parts |= parts < 32 ? 1u << parts : 0u;
  }
  if (effects != p->effects || candidate->n != p->n || integrator != p->integrator || candidate->dt > p->longest) {
    out[0] += p->miss[integrator];
  }
  return FB_OK;
}

/* A search among the bodies of two modes by that judge, to a quarter. */
static fb_status search_for(picky *p)
{
  fb_real output, reference;
  fb_trial trial;
  memset(&trial, 0, sizeof trial);
  trial.run = pick;
  trial.user = p;
  trial.n = trial.width = 1;
  trial.output = &output;
  trial.reference = &reference;
  memset(&work, 0xff, sizeof work); /* it means nothing between calls */
  return fb_advice_search(&advice, &work, &shape, &level, &envelope, FB_R(0.25), &trial);
}

static void new_judge(picky *p, unsigned effects, int n, int integrator)
{
  memset(p, 0, sizeof *p);
  p->effects = effects;
  p->n = n;
  p->integrator = integrator;
  p->longest = FB_HUGE;
  for (int s = 0; s < 4; s++) {
    p->miss[s] = FB_R(2.0);
  }
  boom_under_a_force(0.5, 1, 1);
  envelope.spin[2] = FB_R(0.5);
}

static const char *const column[] = {"rk4", "midpoint", "sdirk", "exponential"};
FBT_ONE_EACH(column, FB_INTEGRATOR_COUNT);

/* E13.13: the estimated costs of steps are those of counted instructions (step_instructions.csv): each integrator, a
   base that flies and one that is held, without and with terms of second degree, 2 to 12 modes. */
TEST(costs_are_those_of_counted_instructions)
{
  static picky p; /* takes anything */
  const fb_real center[3] = {0, 0, 0}, inertia[6] = {80, 80, 80, 0, 0, 0};
  const fbt_table *table = fbt_reference("step_instructions.csv");
  for (int row = 0; row < table->rows; row++) {
    const unsigned effects = (unsigned)fbt_value(table, row, "effects");
    const int y = (int)fbt_value(table, row, "y"), z = (int)fbt_value(table, row, "z");
    const int set = effects == FB_EFFECTS_LINEAR ? 0
                    : effects == FB_EFFECTS_FULL ? FBI_ADVICE_SETS - 2
                                                 : FBI_ADVICE_SETS - 3;
    boom_under_a_force(0.5, y, z);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(500.0), center, inertia), FB_OK);
    level.base = strcmp(fbt_word(table, row, "base"), "free") == 0 ? FB_BASE_FREE : FB_BASE_PRESCRIBED;
    memset(&p, 0, sizeof p);
    FBT_INT_EQ(search_for(&p), FB_OK);
    for (int s = 0; s < (int)FB_INTEGRATOR_COUNT; s++) {
      FBT_NEAR_REL(work.step_cost[set][shape.n - 1][s], fbt_value(table, row, column[s]), 0.12);
    }
  }
}

/* E13.15: gravity, however strong, shortens no step of what flies: rk4's longest is that of the body at its spin. */
TEST(gravity_shortens_no_step_of_a_free_body)
{
  const fb_real center[3] = {0, 0, 0}, inertia[6] = {5, 5, 5, 0, 0, 0};
  static picky p; /* takes anything */
  memset(&p, 0, sizeof p);
  boom_under_a_force(0.5, 1, 1);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(20.0), center, inertia), FB_OK);
  level.base = FB_BASE_FREE;
  envelope.spin[2] = FB_R(0.5);
  envelope.acceleration[0] = FB_R(100.0);
  FBT_INT_EQ(search_for(&p), FB_OK);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
  FBT_NEAR_REL(work.longest[FBI_ADVICE_SETS - 2][1][FB_INTEGRATOR_RK4], fb_rk4_limit(&body, FB_R(0.5), FB_R(0.0)),
               FBT_TOL(1e-12, 1e-6));
}

/* Interface: whatever alone will do is found: any set of effects, number of modes and integrator; in a step that is not
   beyond rk4's limit. The cost of a step, and what does not come of the simulations, is what it is without them. */
TEST(search_finds_what_alone_will_do)
{
  static const unsigned set[4] = {FB_EFFECTS_LINEAR, FB_EFFECTS_SPIN, FB_EFFECTS_LINEAR | FB_EFFECT_SPIN_STIFFENING,
                                  FB_EFFECTS_FULL};
  static picky p;
  fb_advice without;
  for (int k = 0; k < 32; k++) {
    new_judge(&p, set[k / 8], 1 + k / 4 % 2, k % 4);
    FBT_INT_EQ(search_for(&p), FB_OK);
    FBT_INT_EQ(advice.effects, p.effects);
    FBT_INT_EQ(advice.n, p.n);
    FBT_INT_EQ(advice.integrator, p.integrator);
    FBT_INT_EQ(advice.n_trial, p.n_run);
    FBT_NEAR_ABS(advice.error, 0.0, 0.0);
    FBT_TRUE(advice.integrator != FB_INTEGRATOR_RK4 || advice.long_step == 0);
  }
  if (FB_WITH_LARGE_DEFLECTION) {
    new_judge(&p, FB_EFFECTS_LARGE, 2, (int)FB_INTEGRATOR_RK4);
    FBT_INT_EQ(search_for(&p), FB_OK);
    FBT_INT_EQ(advice.effects, FB_EFFECTS_LARGE);
    FBT_NEAR_ABS(advice.error_model, 0.0, 0.0);
    FBT_TRUE(advice.error_field > FB_R(0.0));
  }
  new_judge(&p, 0u, 0, 0);
  FBT_INT_EQ(fb_advice_solve(&without, &work, &shape, &level, &envelope, FB_R(0.01)), FB_OK);
  new_judge(&p, without.effects, without.n, (int)without.integrator);
  FBT_INT_EQ(search_for(&p), FB_OK);
  FBT_NEAR_REL(advice.cost * advice.dt, without.cost * without.dt, FBT_TOL(1e-12, 1e-5));
  FBT_NEAR_REL(advice.deflection, without.deflection, FBT_TOL(1e-12, 1e-5));
  FBT_NEAR_REL(advice.error_model, without.error_model, FBT_TOL(1e-12, 1e-5));
  FBT_NEAR_ABS(fbt_difference(advice.without, without.without, FB_ADVICE_EFFECTS), 0.0, FBT_TOL(1e-12, 1e-5));
}

/* Interface: the last that is tried is the reference's own run, with what it costs; what is off by the tolerance meets
   it. */
TEST(search_ends_with_the_run_of_the_reference)
{
  static picky p;
  new_judge(&p, FB_WITH_LARGE_DEFLECTION ? FB_EFFECTS_LARGE : FB_EFFECTS_FULL, 2, (int)FB_INTEGRATOR_RK4);
  FBT_INT_EQ(search_for(&p), FB_OK);
  new_judge(&p, FB_WITH_LARGE_DEFLECTION ? FB_EFFECTS_LARGE : FB_EFFECTS_FULL, 2, (int)FB_INTEGRATOR_RK4);
  p.longest = FB_R(1.0001) * advice.dt / 4; /* a quarter of the longest, as the reference has it */
  FBT_INT_EQ(search_for(&p), FB_OK);
  FBT_NEAR_REL(advice.dt, p.first.dt, FBT_TOL(1e-12, 1e-5));
  FBT_NEAR_REL(advice.cost, p.first.cost, FBT_TOL(1e-12, 1e-5));
  new_judge(&p, 0u, 0, 0);
  for (int s = 0; s < 4; s++) {
    p.miss[s] = FB_R(0.25);
  }
  FBT_INT_EQ(search_for(&p), FB_OK);
  FBT_INT_EQ(advice.n_trial, 2);
  FBT_NEAR_ABS(advice.error, 0.25, 0.0);
}

/* Interface: a body that misses it alike by two steps of an integrator is tried no more, one that does not is: by each
   of its integrators for itself. Steps are parts of the frame, half as long every second time. */
TEST(search_gives_up_bodies_that_miss_alike)
{
  static picky p;
  int bodies = 0;
  new_judge(&p, 0u, 0, 0);
  for (int s = 0; s < 4; s++) {
    p.miss[s] = FB_R(0.32) + FB_R(0.04) * (fb_real)s;
  }
  FBT_INT_EQ(search_for(&p), FB_ERR_CONVERGENCE);
  for (int k = 0; k < 3 * SETS; k++) {
    const int *const tries = p.tries[k / 3][k % 3];
    int all = 0, most = 0;
    for (int s = 0; s < 4; s++) {
      all += tries[s];
      most = tries[s] > most ? tries[s] : most;
    }
    FBT_TRUE(all == 0 || (most == 2 && all <= 5));
    bodies += all > 0;
  }
  FBT_TRUE(bodies > 4);
  new_judge(&p, 0u, 0, 0);
  level.effects |= (unsigned)FB_EFFECT_DAMPING;
  level.zeta[1] = FB_R(2.0); /* rk4's own steps are short: up to its cost there is room for many of the others */
  envelope.frame = FB_R(0.5);
  FBT_INT_EQ(search_for(&p), FB_ERR_CONVERGENCE);
  FBT_INT_EQ(p.parts & (1u << 2 | 1u << 4 | 1u << 8), 1u << 2 | 1u << 4 | 1u << 8);
}

/* A scene that refuses large deflection is judged without it; an integrator that refuses lines is not tried with them,
   and one of which that is not known once. */
typedef struct refuser {
  unsigned refused; /* effects */
  int n_run, n_refused;
  unsigned last; /* effects of the last run */
} refuser;

static fb_status refuse(void *user, fb_real *out, const fb_advice *candidate)
{
  refuser *const r = (refuser *)user;
  const int no = (candidate->effects & r->refused) != 0 && (r->n_run > 0 || r->refused == FB_EFFECT_LARGE_DEFLECTION);
  out[0] = r->n_run++ - r->n_refused > 0 ? FB_R(3.0) : FB_R(1.0);
  r->n_refused += no;
  r->last = candidate->effects;
  return no ? FB_ERR_UNSUPPORTED : FB_OK;
}

/* Interface: a scene that refuses an effect is asked again without it, once for each set and integrator. */
TEST(scenes_may_refuse_large_deflection)
{
  fb_real output, reference;
  refuser r;
  fb_trial trial;
  memset(&trial, 0, sizeof trial);
  trial.run = refuse;
  trial.user = &r;
  trial.n = trial.width = 1;
  trial.output = &output;
  trial.reference = &reference;
  for (int k = 0; k < 2; k++) {
    memset(&r, 0, sizeof r);
    r.refused = k ? (unsigned)FB_EFFECT_SPIN_COUPLING : (unsigned)FB_EFFECT_LARGE_DEFLECTION;
    boom_under_a_force(0.5, 0, 2);
    envelope.spin[0] = FB_R(0.1);
    FBT_INT_EQ(fb_advice_search(&advice, &work, &shape, &level, &envelope, FB_R(0.25), &trial), FB_ERR_CONVERGENCE);
    FBT_TRUE(r.n_run > 10);
    if (k == 0) {
      FBT_INT_EQ(r.n_refused, FB_WITH_LARGE_DEFLECTION); /* the reference alone */
    } else { /* once by set and integrator: five sets of which two have all effects */
      FBT_TRUE(r.n_refused > 4 && r.n_refused <= 7 * (int)FB_INTEGRATOR_COUNT);
    }
  }
}

/* The error is the largest distance of samples, of the largest sample. */
static fb_status four_numbers(void *user, fb_real *out, const fb_advice *candidate)
{
  const double exact[4] = {3.0, 4.0, 0.0, 1.0}, off[4] = {3.3, 4.4, 0.4, 1.0};
  int *const n_run = (int *)user;
  (void)candidate;
  for (int k = 0; k < 4; k++) {
    out[k] = (fb_real)(*n_run > 0 ? off[k] : exact[k]);
  }
  ++*n_run;
  return FB_OK;
}

/* E13.12: the error is the largest distance of two samples by the largest sample, of one number or of two. */
TEST(errors_are_distances_of_samples)
{
  for (int width = 1; width <= 2; width++) {
    fb_real output[4], reference[4];
    int n_run = 0;
    fb_trial trial;
    memset(&trial, 0, sizeof trial);
    trial.run = four_numbers;
    trial.user = &n_run;
    trial.n = 4;
    trial.width = width;
    trial.output = output;
    trial.reference = reference;
    boom_under_a_force(0.5, 1, 1);
    FBT_INT_EQ(fb_advice_search(&advice, &work, &shape, &level, &envelope, FB_R(0.2), &trial), FB_OK);
    FBT_NEAR_REL(advice.error, width > 1 ? 0.5 / 5.0 : 0.4 / 4.0, FBT_TOL(1e-12, 1e-5));
  }
}

typedef struct spoiled { /* what is wrong with the outputs */
  fb_real reference, sample;
  fb_status status;
  int n_run;
  fb_real longest; /* step */
} spoiled;

/* Two samples of the reference, the first of all others. */
static fb_status spoil(void *user, fb_real *out, const fb_advice *candidate)
{
  spoiled *const s = (spoiled *)user;
  const fb_real dt = candidate->dt;
  out[0] = s->n_run == 0 ? s->reference : s->sample;
  out[1] = s->n_run == 0 ? s->reference : FB_R(1.0);
  s->longest = dt > s->longest ? dt : s->longest;
  return s->n_run++ == 0 ? s->status : FB_OK;
}

/* Interface: what is not a number anywhere in an output does not meet a tolerance; a reference that is no measure is
   refused after the first run, one that cannot be simulated with what it says. */
TEST(search_takes_no_nonsense_for_an_answer)
{
  const struct {
    spoiled s;
    fb_status expected;
  } run[] = {{{FB_R(1.0), FB_R(1.0), FB_OK, 0, FB_R(0.0)}, FB_OK},
             {{FB_R(1.0), FB_R(1.2), FB_OK, 0, FB_R(0.0)}, FB_ERR_CONVERGENCE},
             {{FB_R(1.0), (fb_real)NAN, FB_OK, 0, FB_R(0.0)}, FB_ERR_CONVERGENCE},
             {{FB_R(1.0), (fb_real)INFINITY, FB_OK, 0, FB_R(0.0)}, FB_ERR_CONVERGENCE},
             {{FB_R(0.0), FB_R(1.0), FB_OK, 0, FB_R(0.0)}, FB_ERR_VALUE},
             {{(fb_real)NAN, FB_R(1.0), FB_OK, 0, FB_R(0.0)}, FB_ERR_NOT_FINITE},
             {{FB_R(1.0), FB_R(1.0), FB_ERR_RANGE, 0, FB_R(0.0)}, FB_ERR_RANGE}};
  for (int k = 0; k < FBT_COUNT(run); k++) {
    fb_real output[2], reference[2];
    spoiled s = run[k].s;
    fb_trial trial;
    memset(&trial, 0, sizeof trial);
    trial.run = spoil;
    trial.user = &s;
    trial.n = 2;
    trial.width = 1;
    trial.output = output;
    trial.reference = reference;
    boom_under_a_force(0.5, 1, 2);
    envelope.frame = FB_R(25.0); /* longer than the scene */
    advice.n = -7;
    FBT_INT_EQ(fb_advice_search(&advice, &work, &shape, &level, &envelope, FB_R(0.1), &trial), run[k].expected);
    FBT_TRUE((advice.n == -7) == (run[k].expected != FB_OK));
    FBT_TRUE(s.longest <= envelope.duration);
    FBT_TRUE(k < 4 ? s.n_run > 1 && s.n_run <= 1 + 128 * FBI_ADVICE_SETS * shape.n : s.n_run == 1);
    trial.width = 3;
    FBT_INT_EQ(fb_advice_search(&advice, &work, &shape, &level, &envelope, FB_R(0.1), &trial), FB_ERR_VALUE);
  }
}

/* The tip of the boom as its base spins up to 8 rad/s in 6 s, above the first frequency of 5.2 rad/s in its plane. */
static fb_status spin_up(void *user, fb_real *out, const fb_advice *candidate)
{
  static fb_rk4_work rk4;
  static fb_implicit_work implicit;
  static fb_exponential exponential;
  static fb_exponential_work scratch;
  fb_input input[3];
  fb_state state;
  const int steps = (int)lround(0.1 / (double)candidate->dt);
  fb_status status = fb_shape_select(&other, &shape, candidate->coordinate, candidate->n);
  fb_body_desc desc = level;
  desc.effects = candidate->effects;
  desc.allow_long_step = 1;
  (void)user;
  memset(input, 0, sizeof input);
  status = status ? status : fb_body_init(&twin, &body_work, &other, &desc);
  status = status ? status : fb_state_init(&twin, &state);
  if (status == FB_OK && candidate->integrator == FB_INTEGRATOR_EXPONENTIAL) {
    status = fb_exponential_init(&exponential, &body_work, &twin, candidate->dt);
  }
  for (int k = 0; k < 80 * steps && status == FB_OK; k++) {
    for (int j = 0; j < 3; j++) {
      const double t = ((double)k + 0.5 * j) * (double)candidate->dt, pi = 3.14159265358979323846;
      input[j].w[2] = (fb_real)(t < 6.0 ? 8.0 * (t / 6.0 - sin(2 * pi * t / 6.0) / (2 * pi)) : 8.0);
      input[j].w_dot[2] = (fb_real)(t < 6.0 ? 8.0 / 6.0 * (1.0 - cos(2 * pi * t / 6.0)) : 0.0);
    }
    status = candidate->integrator == FB_INTEGRATOR_RK4
                 ? fb_rk4_step(&twin, &state, &rk4, input, input + 1, input + 2, candidate->dt)
             : candidate->integrator == FB_INTEGRATOR_MIDPOINT
                 ? fb_midpoint_step(&twin, &state, &implicit, input + 1, candidate->dt, 0)
             : candidate->integrator == FB_INTEGRATOR_SDIRK
                 ? fb_sdirk_step(&twin, &state, &implicit, input, input + 2, candidate->dt, 0)
                 : fb_exponential_step(&twin, &exponential, &state, &scratch, input, input + 1, input + 2);
    if ((k + 1) % steps == 0) {
      fb_motion motion;
      fb_node_motion tip;
      memset(&motion, 0, sizeof motion);
      status = status ? status : fb_body_node_motion_eval(&twin, &tip, &state, &motion, 1);
      out[(k + 1) / steps - 1] = status == FB_OK ? tip.displacement[1] : FB_R(0.0);
    }
  }
  return status;
}

/* E13.3, E13.14: a boom that spins up to above its first frequency: the advice without simulation has the stiffening
   and the inertia that follows the shape, and meets its tolerance; so does the search; without one of its effects it is
   missed. */
TEST(advice_meets_its_tolerance)
{
  static fb_real output[80], reference[80];
  const double tolerance[2] = {0.02, 0.002};
  fb_trial trial;
  boom_under_a_force(0.0, 4, 2);
  envelope.spin[2] = FB_R(8.0);
  envelope.spin_rate[2] = FB_R(16.0) / FB_R(6.0);
  envelope.frequency = FB_R(1.0472);
  envelope.duration = FB_R(8.0);
  envelope.frame = FB_R(0.1);
  memset(&trial, 0, sizeof trial);
  trial.run = spin_up;
  trial.n = 80;
  trial.width = 1;
  trial.output = output;
  trial.reference = reference;
  for (int k = 0; k < 2; k++) {
    const unsigned needed = FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA | FB_EFFECT_SPIN_STIFFENING;
    double size = 0.0;
    FBT_INT_EQ(fb_advice_search(&advice, &work, &shape, &level, &envelope, (fb_real)tolerance[k], &trial), FB_OK);
    FBT_BELOW(advice.error, tolerance[k]);
    FBT_INT_EQ(advice.effects & needed, needed);
    advice.effects &= ~(unsigned)(FB_EFFECT_RESIDUAL_INERTIA | FB_EFFECT_SPIN_STIFFENING);
    for (int i = 0; i < 80; i++) {
      size = fmax(size, fabs((double)reference[i]));
    }
    FBT_INT_EQ(spin_up(NULL, output, &advice), FB_OK);
    FBT_TRUE(fbt_difference(output, reference, 80) > tolerance[k] * size);
    FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, (fb_real)tolerance[k]), FB_OK);
    FBT_INT_EQ(advice.effects & needed, needed);
    FBT_INT_EQ(spin_up(NULL, output, &advice), FB_OK);
    FBT_BELOW(fbt_difference(output, reference, 80), tolerance[k] * size);
  }
}

/* ---- a hub with two booms */

#define SWINGS 80
/* The output while the load of the envelope acts on a body that flies from rest, as one period of a sine. */
static fb_status swing(void *user, fb_real *out, const fb_advice *candidate)
{
  static fb_rk4_work rk4;
  static fb_implicit_work implicit;
  static fb_exponential exponential;
  static fb_exponential_work scratch;
  fb_input input[3];
  fb_state state;
  const int steps = (int)lround((double)envelope.duration / SWINGS / (double)candidate->dt);
  const fb_real dt = envelope.duration / (fb_real)(SWINGS * steps);
  fb_status status = fb_shape_select(&other, &shape, candidate->coordinate, candidate->n);
  fb_body_desc desc = level;
  desc.effects = candidate->effects;
  desc.allow_long_step = 1;
  (void)user;
  memset(input, 0, sizeof input);
  status = status ? status : fb_body_init(&twin, &body_work, &other, &desc);
  status = status ? status : fb_state_init(&twin, &state);
  if (status == FB_OK && candidate->integrator == FB_INTEGRATOR_EXPONENTIAL) {
    status = fb_exponential_init(&exponential, &body_work, &twin, dt);
  }
  for (int k = 0; k < SWINGS * steps && status == FB_OK; k++) {
    for (int j = 0; j < 3; j++) {
      const double phase = (double)envelope.frequency * ((double)k + 0.5 * j) * (double)dt;
      const fb_real now = phase < 6.2831853 ? (fb_real)sin(phase) : FB_R(0.0);
      input[j].n_load = 1;
      input[j].load[0] = envelope.load[0];
      for (int i = 0; i < 3; i++) {
        input[j].load[0].force[i] *= now;
        input[j].load[0].torque[i] *= now;
      }
    }
    status =
        candidate->integrator == FB_INTEGRATOR_RK4 ? fb_rk4_step(&twin, &state, &rk4, input, input + 1, input + 2, dt)
        : candidate->integrator == FB_INTEGRATOR_MIDPOINT ? fb_midpoint_step(&twin, &state, &implicit, input + 1, dt, 0)
        : candidate->integrator == FB_INTEGRATOR_SDIRK
            ? fb_sdirk_step(&twin, &state, &implicit, input, input + 2, dt, 0)
            : fb_exponential_step(&twin, &exponential, &state, &scratch, input, input + 1, input + 2);
    if ((k + 1) % steps == 0) {
      fb_motion motion;
      fb_node_motion tip;
      memset(&motion, 0, sizeof motion);
      status = status ? status : fb_body_node_motion_eval(&twin, &tip, &state, &motion, envelope.node);
      out[(k + 1) / steps - 1] = status == FB_OK ? tip.displacement[1] : FB_R(0.0);
    }
  }
  return status;
}

/* Largest difference from all modes and effects, relative. */
static double off_by(const fb_advice *candidate)
{
  static fb_real out[SWINGS], reference[SWINGS];
  const fb_advice all = all_of(candidate);
  FBT_INT_EQ(swing(NULL, reference, &all), FB_OK);
  FBT_INT_EQ(swing(NULL, out, candidate), FB_OK);
  return fbt_difference(out, reference, SWINGS) / fbt_largest(reference, SWINGS);
}

/* E13.8, E13.9: of two equal booms of 5 + 5 modes a torque about z drives those in its plane, and of them the
   difference alone: a pair of modes meets 10 %, two pairs meet 1 %; in a body with one boom's modes alone the base
   would recoil from half of it. The same after a push on the tip that is looked at, along y. */
TEST(two_booms_take_the_modes_that_the_load_drives)
{
  for (int k = 0; k < 4; k++) {
    const double tolerance = k % 2 ? 0.01 : 0.1;
    make_two_booms(5, 5);
    envelope.frequency = k < 2 ? FB_R(0.7854) : FB_R(2.0);
    envelope.duration = FB_R(20.0);
    envelope.frame = FB_R(0.25);
    envelope.load[0].torque[2] = k < 2 ? FB_R(6.0) : FB_R(0.0);
    envelope.load[0].force[1] = k < 2 ? FB_R(0.0) : FB_R(0.2);
    envelope.load[0].node = k < 2 ? 0 : 1;
    envelope.spin[2] = k < 2 ? FB_R(0.25) : FB_R(0.02);
    FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, (fb_real)tolerance), FB_OK);
    FBT_TRUE(advice.n <= (k % 2 ? 4 : 2) + (k > 1)); /* a push: one more */
    for (int a = 0; a < advice.n; a++) {
      FBT_BELOW(advice.coordinate[a] % 10, 5); /* y */
    }
    FBT_BELOW(off_by(&advice), tolerance);
  }
}

/* Interface: what is missing, not a number or out of range. */
TEST(advice_refuses_nonsense)
{
  static fb_modes modes;
  fb_trial trial;
  boom_under_a_force(0.5, 2, 2);
  advice.n = -7;
  FBT_INT_EQ(fb_advice_solve(NULL, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_NULL);
  FBT_INT_EQ(fb_advice_solve(&advice, NULL, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_NULL);
  FBT_INT_EQ(fb_advice_solve(&advice, &work, NULL, &level, &envelope, FB_R(0.01)), FB_ERR_NULL);
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.0)), FB_ERR_VALUE);
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, (fb_real)NAN), FB_ERR_NOT_FINITE);
  envelope.spin[1] = (fb_real)INFINITY;
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_NOT_FINITE);
  envelope.spin[1] = FB_R(0.0);
  envelope.frequency = -FB_R(1.0);
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_VALUE);
  envelope.frequency = FB_R(0.0);
  envelope.duration = FB_R(0.0);
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_VALUE);
  envelope.duration = FB_R(10.0);
  envelope.frame = -FB_R(1.0);
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_VALUE);
  envelope.frame = FB_R(0.0);
  envelope.lasts = -FB_R(1.0);
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_VALUE);
  envelope.lasts = (fb_real)NAN;
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_NOT_FINITE);
  envelope.lasts = FB_R(0.0);
  envelope.frame = FB_R(1.0) / FB_HUGE; /* no step so short is worth its cost */
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_STEP);
  memset(&trial, 0, sizeof trial);
  trial.run = look_at;
  trial.n = trial.width = 1;
  trial.output = trial.reference = &envelope.frame;
  FBT_INT_EQ(fb_advice_search(&advice, &work, &shape, &level, &envelope, FB_R(0.01), &trial), FB_ERR_STEP);
  envelope.frame = FB_R(0.0);
  envelope.node = 2;
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_CAPACITY);
  envelope.node = 1;
  envelope.load[0].node = 5;
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_CAPACITY);
  envelope.load[0].node = 1;
  envelope.load[0].force[2] = (fb_real)NAN;
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_NOT_FINITE);
  envelope.load[0].force[2] = FB_R(0.0); /* nothing drives the output */
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_VALUE);
  envelope.load[0].force[2] = FB_R(0.5);
  memset(&trial, 0, sizeof trial);
  FBT_INT_EQ(fb_advice_search(&advice, &work, &shape, &level, &envelope, FB_R(0.01), NULL), FB_ERR_NULL);
  FBT_INT_EQ(fb_advice_search(&advice, &work, &shape, &level, &envelope, FB_R(0.01), &trial), FB_ERR_NULL);
  make_boom(&shape, &modes, 2, 2);
  shape.M[1] = shape.M[shape.n] = FB_R(0.5);
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_UNSUPPORTED);
  FBT_INT_EQ(advice.n, -7);
}

SUITE(advise_search, RUN(steps_are_the_longest_parts_of_a_frame), RUN(advice_is_the_cheapest_that_adds_up),
      RUN(integrators_have_their_scenes), RUN(advised_steps_are_within_the_limit),
      RUN(advised_steps_are_those_of_the_spectrum), RUN(drives_may_end_within_a_step),
      RUN_LONG(unknown_ends_are_met_at_their_worst), RUN(known_ends_are_met_by_steps),
      RUN(loads_may_be_taken_away_within_a_step), RUN(drives_leave_free_vibrations_behind),
      RUN(advised_steps_and_points_are_enough), RUN(errors_and_steps_add_up),
      RUN(search_stops_at_the_cheapest_that_will_do), RUN(search_tries_each_part_of_a_frame_once),
      RUN(costs_are_those_of_counted_instructions), RUN(gravity_shortens_no_step_of_a_free_body),
      RUN(search_finds_what_alone_will_do), RUN(search_ends_with_the_run_of_the_reference),
      RUN(search_gives_up_bodies_that_miss_alike), RUN(scenes_may_refuse_large_deflection),
      RUN(errors_are_distances_of_samples), RUN(search_takes_no_nonsense_for_an_answer),
      RUN(advice_meets_its_tolerance), RUN_LONG(two_booms_take_the_modes_that_the_load_drives),
      RUN(advice_refuses_nonsense))
