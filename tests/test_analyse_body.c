/* >>trim and >>linear: states of rest, spectra and linear models of a body. */
#include "analyse.h"

static fb_analyse_work work;

/* E12.1 to E12.3: u_x'' + c_x u_x' - 2 w u_y' + (k_x - w^2) u_x = w^2 R, u_y'' + c_y u_y' + 2 w u_x' + (k_y - w^2) u_y
   = 0 (the dashpots turn with the frame): the particle rests at w^2 R/(k_x - w^2), and the eigenvalues are the roots of
   (l^2 + c_x l + k_x - w^2)(l^2 + c_y l + k_y - w^2) + 4 w^2 l^2, which also gives their number; beyond w^2 = k_x one
   root is positive. */
TEST(spectrum_of_a_spinning_oscillator_is_closed_form)
{
  for (int run = 0; run < 8; run++) {
    const double w = 0.5 * run, kx = 4.0, ky = 9.0, zeta = run % 2 ? 0.05 : 0.0;
    const double cx = 2.0 * zeta * 2.0, cy = 2.0 * zeta * 3.0, a = kx - w * w, b = ky - w * w;
    fb_state state;
    fb_input input;
    double sum = 0.0, unstable = 0.0;
    if (run == 4 || run == 6) {
      continue; /* a or b vanish: no steady state */
    }
    particle_on_springs(0.5, kx, ky, zeta);
    memset(&input, 0, sizeof input);
    input.w[2] = (fb_real)w;
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_OK);
    FBT_NEAR_ABS(state.q[0], w * w * 0.5 / a, FBT_TOL(1e-12, 1e-4));
    FBT_NEAR_ABS(state.q[1], 0.0, FBT_TOL(1e-12, 1e-4));
    FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, &spectrum, &state, &input), FB_OK);
    for (int k = 0; k < spectrum.n; k++) {
      const double x = (double)spectrum.re[k], y = (double)spectrum.im[k];
      const double s = x * x - y * y, t = 2.0 * x * y; /* l^2 */
      const double p = s + cx * x + a, q = t + cx * y, u = s + cy * x + b, v = t + cy * y;
      FBT_NEAR_ABS(p * u - q * v + 4.0 * w * w * s, 0.0, FBT_TOL(2e-11, 1e-2));
      FBT_NEAR_ABS(p * v + q * u + 4.0 * w * w * t, 0.0, FBT_TOL(2e-11, 1e-2));
      sum += x * (y > 0.0 ? 2.0 : 1.0);
      unstable = fmax(unstable, x);
      FBT_NEAR_ABS(fb_spectrum_damping(&spectrum, k), -x / sqrt(x * x + y * y), 8.0 * EPS);
    }
    FBT_NEAR_ABS(sum, -cx - cy, FBT_TOL(1e-11, 1e-3)); /* all four are there: the trace */
    FBT_TRUE((unstable > 0.1) == (w > 2.0 && w < 3.0));
  }
}

/* E12.2: what moves the base as an input: the state of rest q = w^2 R/(k_x - w^2) + w v_y/(k_x - w^2) of that particle,
   of which pi = (v_x, w (R + q) + v_y), follows v and w; A dx + B du = 0. The force on it as an input does so, too. */
TEST(bases_that_move_move_the_state_of_rest)
{
  const double w = 1.2, R = 0.5, kx = 4.0, a = kx - w * w, q = w * w * R / a;
  const double dx[3][4] = {{w / a, 0.0, 0.0, 1.0 + w * w / a},                                   /* by v_y */
                           {2.0 * w * (R + q) / a, 0.0, 0.0, R + q + 2.0 * w * w * (R + q) / a}, /* by w_z */
                           {1.0 / a, 0.0, 0.0, w / a}}; /* by a force along x */
  static fb_linear linear;
  const fb_real r[3] = {(fb_real)R, 0, 0}, psi[6] = {FB_R(1.0), 0, 0, 0, FB_R(1.0), 0}, none[6] = {0};
  fb_linear_desc ports;
  fb_state state;
  fb_input input;
  fb_body_desc desc;
  int node;
  particle_on_springs(R, kx, 9.0, 0.0);
  FBT_INT_EQ(fb_shape_add_node(&shape, &node, r, psi, none), FB_OK);
  memset(&desc, 0, sizeof desc);
  desc.effects = FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA;
  desc.base = FB_BASE_PRESCRIBED;
  desc.deflection_limit = FB_R(10.0);
  desc.allow_split_effects = 1;
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  memset(&input, 0, sizeof input);
  input.w[2] = (fb_real)w;
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_OK);
  memset(&ports, 0, sizeof ports);
  ports.n_in = 3;
  ports.in[0].kind = FB_PORT_BASE_VELOCITY;
  ports.in[0].axis = 1;
  ports.in[1].kind = FB_PORT_BASE_RATE;
  ports.in[1].axis = 2;
  ports.in[2].kind = FB_PORT_FORCE;
  ports.in[2].node = node;
  FBT_INT_EQ(fb_body_linearize(&body, &work, &linear, &state, &input, &ports), FB_OK);
  FBT_INT_EQ(linear.n, 4);
  for (int k = 0; k < 3; k++) {
    for (int i = 0; i < 4; i++) {
      double rate = (double)linear.B[3 * i + k];
      for (int j = 0; j < 4; j++) {
        rate += (double)linear.A[4 * i + j] * dx[k][j];
      }
      FBT_NEAR_ABS(rate, 0.0, FBT_TOL(1e-9, 1e-3));
    }
  }
}

/* E12.3, E8.7: at rest the complex modes are the modes, with their damping ratios, frequencies and shapes. */
TEST(damped_modes_have_their_ratios)
{
  fb_state state;
  fb_input input;
  uniform_line(2.0, 4, 3.0, 50.0, 70.0, 3);
  level.effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING | FB_EFFECT_GRAVITY;
  level.base = FB_BASE_PRESCRIBED;
  level.gravity[1] = -FB_R(0.1);
  for (int k = 0; k < 6; k++) {
    level.zeta[k] = FB_R(0.01) * (fb_real)(k + 1);
  }
  memset(&input, 0, sizeof input);
  beam_body(&body, 0.0, NULL, NULL);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, &spectrum, &state, &input), FB_OK);
  FBT_INT_EQ(spectrum.n, 6);
  for (int k = 0; k < 6; k++) {
    const double re = (double)spectrum.re[k], im = (double)spectrum.im[k];
    double own = 0.0, other = 0.0;
    FBT_NEAR_REL(sqrt(re * re + im * im), modes.omega[k], FBT_TOL(1e-10, 1e-4));
    FBT_NEAR_ABS(fb_spectrum_damping(&spectrum, k), 0.01 * (k + 1), FBT_TOL(1e-11, 1e-4));
    for (int a = 0; a < 6; a++) {
      const double size = hypot((double)spectrum.shape_re[6 * k + a], (double)spectrum.shape_im[6 * k + a]);
      own += a == k ? size : 0.0;
      other += a == k ? 0.0 : size;
    }
    FBT_BELOW(other / own, FBT_TOL(1e-9, 1e-2));
  }
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input),
             FB_OK); /* sag m g L^3/8EI, of which three modes hold nearly all */
  {
    double tip = 0.0;
    for (int a = 0; a < 6; a++) {
      tip += (double)state.q[a] * (double)modes.shape[a * modes.ndof + 6 * 4 + 1];
    }
    FBT_NEAR_REL(tip, -0.1 * 3.0 * 16.0 / (8.0 * 70.0), 1e-3);
  }
}

/* E12.1 to E12.3: a rigid body that spins freely about a principal axis, O off its mass center, base free or pinned:
   Euler's equations give exp(l t) with l^2 = -spin^2 (C - A)(C - B)/(A B), C about the axis: nutation, and growth about
   the middle axis. A free one also has its momentum, which turns at the spin: l = 0 and l^2 = -spin^2. */
TEST(free_tops_nutate_as_euler_says)
{
  static const double inertia[3] = {2.0, 3.0, 4.5};
  for (int run = 0; run < 12; run++) {
    const int axis = run % 3, pinned = run / 3 % 2, far = run >= 6;
    const fb_real turn[3] = {FB_R(0.4), -FB_R(1.1), FB_R(0.7)};
    const double spin = 1.7, C = inertia[axis], A = inertia[(axis + 1) % 3], B = inertia[(axis + 2) % 3];
    const double l2 = -spin * spin * (C - A) * (C - B) / (A * B);
    const fb_real center[3] = {pinned ? FB_R(0.0) : (fb_real)(0.3 * far), pinned ? FB_R(0.0) : -(fb_real)(0.2 * far),
                               0};
    const fb_real J[6] = {(fb_real)inertia[0], (fb_real)inertia[1], (fb_real)inertia[2], 0, 0, 0};
    static fb_body_desc desc;
    fb_state state;
    fb_input input;
    int found = 0;
    memset(&desc, 0, sizeof desc);
    desc.base = pinned ? FB_BASE_PINNED : FB_BASE_FREE;
    FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(5.0), center, J), FB_OK);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
    memset(&input, 0, sizeof input);
    input.w[axis] = (fb_real)spin;
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    fb_quat_from_rotvec(state.quat, turn);
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_OK);
    FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, &spectrum, &state, &input), FB_OK);
    for (int k = 0; k < spectrum.n; k++) {
      const double re = (double)spectrum.re[k], im = (double)spectrum.im[k];
      const double square = re * re - im * im, tol = FBT_TOL(1e-9, 2e-3);
      found += fabs(square - l2) < tol && fabs(re * im) < tol;
      FBT_TRUE((fabs(square - l2) < tol || fabs(square) < tol || (!pinned && fabs(square + spin * spin) < tol)) &&
               fabs(re * im) < tol);
    }
    FBT_INT_EQ(found, l2 > 0.0 ? 2 : 1);
  }
}

/* E12.1: a body that turns on a hinge is at rest under a weight or a force along its axis, and not under one across it,
   though at this instant nothing turns it: in space a torque does so, too, in the body it goes round with it. In every
   unit of length alike, and what is off by rounding is along. */
TEST(a_weight_across_the_axis_is_no_rest)
{
  static const double unit[3] = {1e-4, 1.0, 1e4};
  for (int k = 0; k < 3; k++) {
    const double u = unit[k], rounding = FBT_TOL(1e-8, 1e-5);
    for (int what = 0; what < 8; what++) {
      const fb_real push = (fb_real)(what % 2 ? 9.0 * u * rounding : 9.0 * u),
                    along = what % 2 ? (fb_real)(9.0 * u) : FB_R(0.0);
      const fb_real center[3] = {(fb_real)(0.3 * u), 0, (fb_real)(0.2 * u)};
      const fb_real J[6] = {(fb_real)(2.0 * u * u), (fb_real)(3.0 * u * u), (fb_real)(4.0 * u * u), 0, 0, 0};
      fb_body_desc desc;
      fb_state state;
      fb_input input;
      memset(&desc, 0, sizeof desc);
      memset(&input, 0, sizeof input);
      desc.base = FB_BASE_HINGED;
      input.w[2] = FB_R(1.0);
      input.load[0].axes = what < 6 ? FB_AXES_INERTIAL : FB_AXES_BODY;
      if (what < 2) { /* weight: across, along */
        desc.effects = FB_EFFECT_GRAVITY;
        desc.gravity[0] = push;
        desc.gravity[2] = along;
      } else if (what < 4) { /* force: across, along */
        input.n_load = 1;
        input.load[0].force[0] = push;
        input.load[0].force[2] = along;
      } else { /* torque across, in space, in the body; next to nothing beside a force along */
        input.n_load = 1;
        input.load[0].torque[0] = push * (fb_real)u;
        input.load[0].force[2] = along;
      }
      FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
      FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(5.0), center, J), FB_OK);
      FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
      FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
      FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), what % 2 || what == 6 ? FB_OK : FB_ERR_UNREST);
    }
  }
}

/* E12.1: a body that turns on a hinge about no principal axis rests: the hinge bears what turns its angular momentum,
   and a torque across that goes round with it; not one about the hinge. */
TEST(a_hinge_turns_what_spins_about_no_axis_of_its_own)
{
  for (int run = 0; run < 3; run++) { /* no torque, across, about */
    const fb_real center[3] = {FB_R(0.3), FB_R(0.1), FB_R(-0.2)};
    const fb_real J[6] = {FB_R(2.0), FB_R(3.0), FB_R(4.0), FB_R(0.1), FB_R(0.5), FB_R(-0.3)};
    fb_body_desc desc;
    fb_state state;
    fb_input input;
    memset(&desc, 0, sizeof desc);
    memset(&input, 0, sizeof input);
    desc.base = FB_BASE_HINGED;
    input.w[2] = FB_R(1.5);
    input.n_load = run > 0;
    input.load[0].axes = FB_AXES_BODY;
    input.load[0].torque[run == 1 ? 0 : 2] = FB_R(0.4);
    FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(5.0), center, J), FB_OK);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), run == 2 ? FB_ERR_UNREST : FB_OK);
  }
}

/* E12.1: about any axis in the span of equal inertias a body spins freely, so it does about the one that is wanted: a
   sphere about all, a disc about all in its plane; from other directions about the nearest of them, or about its
   own. */
TEST(equal_inertias_spin_about_any_of_their_axes)
{
  static const double wanted[5][3] = {
      {0.3, -0.8, 0.5}, {1.1, 0.7, 0.0}, {-0.4, 0.9, 0.0}, {0.9, 1.2, 0.8}, {0.5, -0.4, 0.9}};
  static const double kept[5][3] = {
      {1.0, 1.0, 1.0}, {1.0, 1.0, 0.0}, {1.0, 1.0, 0.0}, {1.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  for (int run = 0; run < 10; run++) {
    static fb_body_desc desc;
    const fb_real center[3] = {FB_R(0.2), -FB_R(0.1), FB_R(0.3)};
    const fb_real m = run < 5 ? FB_R(1.0) : FB_R(0.0625); /* light ones, too */
    const fb_real J[6] = {FB_R(2.0) * m, FB_R(2.0) * m, (run % 5 ? FB_R(3.0) : FB_R(2.0)) * m, 0, 0, 0};
    const double *const w = wanted[run % 5], *const own = kept[run % 5];
    const double share[3] = {w[0] * own[0], w[1] * own[1], w[2] * own[2]};
    const double stretch = sqrt((w[0] * w[0] + w[1] * w[1] + w[2] * w[2]) /
                                (share[0] * share[0] + share[1] * share[1] + share[2] * share[2]));
    fb_state state;
    fb_input input;
    fb_motion motion;
    FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(5.0) * m, center, J), FB_OK);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
    memset(&input, 0, sizeof input);
    for (int i = 0; i < 3; i++) {
      input.w[i] = (fb_real)w[i];
    }
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_OK);
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &input), FB_OK);
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(motion.w[i], stretch * share[i], FBT_TOL(1e-13, 1e-5));
    }
  }
}

/* E12.1 to E12.3: a free axisymmetric body (A, A, C) that spins about z and carries a nutation damper: a particle at R
   on the x axis, sprung and damped along z. Euler's equations and the particle's, linear in w_1, w_2 and its z, mu the
   reduced mass: A w_1' + s (C - A) w_2 = 0,  (A + mu R^2) w_2' + s (A - C - mu R^2) w_1 - mu R (z'' + s^2 z) = 0,
   mu (z'' - R w_2' + s R w_1) + c z' + k z = 0. The eigenvalues are the roots of their determinant. The damper calms a
   spin about the major axis and drives one about the minor axis away (Kelvin, Bracewell). */
TEST(damped_spinning_satellite_has_its_closed_form)
{
  for (int run = 0; run < 6; run++) {
    const double A = 3.0, C = run % 2 ? 4.2 : 1.9, hub = 20.0, m = 0.4 + 0.3 * run, R = 0.7, k = 9.0, zeta = 0.1;
    const double mu = m * hub / (m + hub), spin = 1.0 + 0.2 * run, c = 2.0 * zeta * sqrt(k * m), mR2 = mu * R * R;
    static fb_body_desc desc;
    const fb_real center[3] = {0}, J[6] = {(fb_real)A, (fb_real)A, (fb_real)C, 0, 0, 0};
    const fb_real r[3] = {(fb_real)R, 0, 0}, psi[3] = {0, 0, FB_R(1.0)};
    fb_state state;
    fb_input input;
    double growth = -1.0;
    int found = 0;
    memset(&desc, 0, sizeof desc);
    FBT_INT_EQ(fb_shape_init(&shape, 1), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)hub, center, J), FB_OK);
    FBT_INT_EQ(fb_shape_add_particle(&shape, (fb_real)m, r, psi, NULL), FB_OK);
    shape.K[0] = (fb_real)k;
    desc.effects = FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA | FB_EFFECT_DAMPING;
    desc.zeta[0] = (fb_real)zeta;
    desc.deflection_limit = FB_R(10.0);
    desc.allow_split_effects = 1; /* a particle has no foreshortening */
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
    memset(&input, 0, sizeof input);
    input.w[2] = (fb_real)spin;
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_OK);
    FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, &spectrum, &state, &input), FB_OK);
    for (int i = 0; i < spectrum.n; i++) {
      const number l = {(double)spectrum.re[i], (double)spectrum.im[i]}, one = {1.0, 0.0}, zero = {0.0, 0.0};
      const number l2 = times(l, l), s = plus(l2, spin * spin, one), D = plus(plus(plus(zero, mu, l2), c, l), k, one);
      const number first = plus(plus(zero, A + mR2, times(l2, D)), -mu * mR2, times(l2, s));
      const number second = plus(plus(zero, A - C - mR2, D), mu * mR2, s);
      const number det = plus(plus(zero, A, first), -spin * spin * (C - A), second);
      if (hypot(l.re, l.im) > 0.05 &&
          hypot(s.re, s.im) > 0.05) { /* neither a spin-up nor a drift: those are 0 and i spin */
        FBT_NEAR_ABS(hypot(det.re, det.im), 0.0, FBT_TOL(1e-9, 1e-2));
        growth = fmax(growth, l.re);
        found += l.im > 0.0 ? 2 : 1;
      }
    }
    FBT_INT_EQ(found, 4);
    FBT_TRUE((growth > 0.0) == (C < A));
  }
}

/* E12.2: the linear model, integrated, answers to small forces and torques as the body does, about a free spin: rates,
   deflections and accelerations of hub and tip. */
TEST(linear_models_answer_as_the_body_does)
{
  static fb_linear linear;
  const fb_real center[3] = {0}, J[6] = {FB_R(30.0), FB_R(40.0), FB_R(60.0), 0, 0, 0};
  const double size = FBT_TOL(1e-3, 1e-1), dt = 1e-3; /* of the loads */
  fb_linear_desc ports;
  fb_state state, steady;
  fb_input input, loads;
  fb_rk4_work rk4;
  double x[FB_MAX_LINEAR] = {0}, base[8] = {0}, worst[8] = {0}, most[8] = {0};
  const int node = 1;
  uniform_line(5.0, 6, 1.0, 300.0, 500.0, 2);
  level.effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING;
  for (int a = 0; a < 4; a++) {
    level.zeta[a] = FB_R(0.02);
  }
  beam_body(&body, 100.0, center, J);
  memset(&input, 0, sizeof input);
  input.w[2] = FB_R(0.8);
  FBT_INT_EQ(fb_state_init(&body, &steady), FB_OK);
  FBT_INT_EQ(fb_body_trim(&body, &steady, &work, &input), FB_OK);
  memset(&ports, 0, sizeof ports);
  ports.n_in = 2;
  ports.in[0].axis = 1; /* torque of the hub about y, force on the tip along y */
  ports.in[0].kind = FB_PORT_TORQUE;
  ports.in[1].axis = 1;
  ports.in[1].node = node;
  ports.n_out = 8;
  for (int k = 0; k < 8; k++) {
    ports.out[k].kind = k < 3   ? FB_PORT_RATE
                        : k < 5 ? FB_PORT_DISPLACEMENT
                        : k < 7 ? FB_PORT_ACCELERATION
                                : FB_PORT_ROTATION;
    ports.out[k].node = k < 2 ? 0 : node;
    ports.out[k].axis = k < 2 ? k + 1 : 1 + k % 2;
  }
  FBT_INT_EQ(fb_body_linearize(&body, &work, &linear, &steady, &input, &ports), FB_OK);
  FBT_INT_EQ(linear.n, 2 * (4 + 6));
  state = steady;
  for (int step = -1; step < 2000; step++) {
    const double u[2] = {size * cos(0.003 * step), step < 500 ? size : 0.0};
    fb_motion motion;
    memset(&loads, 0, sizeof loads);
    if (step >= 0) {
      loads.n_load = 2;
      loads.load[0].axes = loads.load[1].axes = FB_AXES_BODY;
      loads.load[0].torque[1] = (fb_real)u[0];
      loads.load[1].force[1] = (fb_real)u[1];
      loads.load[1].node = node;
      FBT_INT_EQ(fb_rk4_step(&body, &state, &rk4, &loads, &loads, &loads, (fb_real)dt), FB_OK);
      linear_step(x, &linear, u, dt);
    }
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &loads), FB_OK);
    for (int k = 0; k < 8; k++) {
      fb_node_motion at;
      fb_imu imu;
      double y;
      FBT_INT_EQ(fb_body_node_motion_eval(&body, &at, &state, &motion, ports.out[k].node), FB_OK);
      fb_imu_eval(&imu, &at, NULL);
      y = (double)(k < 3   ? imu.angular_rate
                   : k < 5 ? at.displacement
                   : k < 7 ? imu.specific_force
                           : at.rotation)[ports.out[k].axis];
      base[k] = step < 0 ? y : base[k];
      worst[k] = fmax(worst[k], fabs(y - base[k] - (step < 0 ? 0.0 : linear_output(&linear, x, u, k))));
      most[k] = fmax(most[k], fabs(y - base[k]));
    }
  }
  for (int k = 0; k < 8; k++) {
    FBT_BELOW(worst[k] / most[k], FBT_TOL(1e-4, 3e-2));
  }
}

/* E12.2: at rest under loads that its steady state does not know a body begins to move by rate = B u. */
TEST(linear_models_tell_how_a_state_moves_on)
{
  static fb_linear linear;
  const fb_real center[3] = {0}, J[6] = {FB_R(30.0), FB_R(40.0), FB_R(60.0), 0, 0, 0};
  const double force = 2.0, torque = 3.0;
  fb_linear_desc ports;
  fb_state state;
  fb_input input;
  uniform_line(5.0, 6, 1.0, 300.0, 500.0, 2);
  level.effects = FB_EFFECTS_FULL;
  beam_body(&body, 100.0, center, J);
  memset(&ports, 0, sizeof ports);
  ports.n_in = 2;
  ports.in[0].kind = FB_PORT_TORQUE;
  ports.in[0].axis = 1;
  ports.in[1].axis = 1;
  ports.in[1].node = 1;
  memset(&input, 0, sizeof input);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  for (int loaded = 0; loaded < 2; loaded++) {
    double most = 0.0;
    input.n_load = 2 * loaded;
    input.load[0].axes = input.load[1].axes = FB_AXES_BODY;
    input.load[0].torque[1] = (fb_real)torque;
    input.load[1].node = 1;
    input.load[1].force[1] = (fb_real)force;
    FBT_INT_EQ(fb_body_linearize(&body, &work, &linear, &state, &input, &ports), FB_OK);
    for (int i = 0; i < linear.n; i++) {
      const double Bu = loaded * (torque * (double)linear.B[2 * i] + force * (double)linear.B[2 * i + 1]);
      FBT_NEAR_ABS(linear.rate[i], Bu, FBT_TOL(1e-9, 1e-4) * (1.0 + fabs(Bu)));
      most = fmax(most, fabs(Bu));
    }
    FBT_TRUE((most > 0.1) == loaded);
  }
}

static const fb_linear_desc all_ports = {4,
                                         6,
                                         {{FB_PORT_FORCE, 0, 1, 1, FB_AXES_BODY},
                                          {FB_PORT_TORQUE, 0, 0, 2, FB_AXES_BODY},
                                          {FB_PORT_BASE_VELOCITY, 0, 0, 0, FB_AXES_BODY},
                                          {FB_PORT_BASE_RATE, 0, 0, 1, FB_AXES_BODY}},
                                         {{FB_PORT_DISPLACEMENT, 0, 1, 1, FB_AXES_BODY},
                                          {FB_PORT_ROTATION, 0, 1, 2, FB_AXES_BODY},
                                          {FB_PORT_RATE, 0, 0, 2, FB_AXES_BODY},
                                          {FB_PORT_ACCELERATION, 0, 1, 1, FB_AXES_BODY},
                                          {FB_PORT_RATE, 0, 1, 0, FB_AXES_BODY},
                                          {FB_PORT_ACCELERATION, 0, 0, 0, FB_AXES_BODY}}};

/* The linear model of a deflected beam on a hub that turns, drifts and hangs in gravity, in units of u meters, m
   kilograms, and in size those of x, of the inputs and of the outputs. */
static void linear_in_units(fb_linear *linear, double size[3][FB_MAX_LINEAR], fb_base base, double u, double m)
{
  const fb_real center[3] = {(fb_real)(0.2 * u), -(fb_real)(0.1 * u), (fb_real)(0.3 * u)}, J = (fb_real)(m * u * u);
  const fb_real inertia[6] = {FB_R(3.0) * J, FB_R(4.0) * J,  FB_R(5.0) * J,
                              FB_R(0.2) * J, FB_R(-0.3) * J, FB_R(0.4) * J};
  const double mode = u * sqrt(m), frame[4] = {m * u, m * u * u, u, 1.0}; /* momentum, angular; position, angle */
  const double in[4] = {m * u, m * u * u, u, 1.0}, out[6] = {u, 1.0, 1.0, u, 1.0, u};
  const int first = base == FB_BASE_PINNED ? 3 : base == FB_BASE_HINGED ? 5 : base == FB_BASE_PRESCRIBED ? 6 : 0;
  fb_linear_desc ports = all_ports;
  fb_state state;
  fb_input input;
  fb_real turn[3];
  int n = 0;
  uniform_line(5.0 * u, 6, 1.0 * m / u, 300.0 * m * u * u * u, 500.0 * m * u * u * u, 2);
  level.effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING | FB_EFFECT_GRAVITY;
  level.base = base;
  level.gravity[1] = (fb_real)(-2.0 * u);
  level.zeta[0] = level.zeta[2] = FB_R(0.02);
  beam_body(&body, 10.0 * m, center, inertia);
  fbt_seed(7);
  memset(&input, 0, sizeof input);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  fbt_fill(state.q, body.n, 0.1 * mode);
  fbt_fill(input.v, 3, base == FB_BASE_FREE || base == FB_BASE_PRESCRIBED ? 0.3 * u : 0.0);
  fbt_fill(input.w, 3, 0.6);
  fbt_fill(turn, 3, 1.0);
  input.w[0] = base == FB_BASE_HINGED ? FB_R(0.0) : input.w[0];
  input.w[1] = base == FB_BASE_HINGED ? FB_R(0.0) : input.w[1];
  fb_quat_from_rotvec(state.quat, turn);
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, input.v, input.w, NULL), FB_OK);
  ports.n_in = base == FB_BASE_PRESCRIBED ? 4 : 2;
  FBT_INT_EQ(fb_body_linearize(&body, &work, linear, &state, &input, &ports), FB_OK);
  for (; n < 2 * body.n; n++) {
    size[0][n] = mode;
  }
  for (int i = 0; i < 12; i++) {
    if (i % 6 >= first) {
      size[0][n++] = frame[i / 3];
    }
  }
  FBT_INT_EQ(linear->n, n);
  memcpy(size[1], in, sizeof in);
  memcpy(size[2], out, sizeof out);
}

/* E12.2: the linear model is the same in every unit of length and of mass: of rates of momenta and pose, of loads and
   motions of the base as inputs, of what gyros and accelerometers read; every base. */
TEST(linear_models_do_not_depend_on_units)
{
  static const fb_base bases[] = {FB_BASE_FREE, FB_BASE_PRESCRIBED, FB_BASE_PINNED, FB_BASE_HINGED};
  static fb_linear one, other;
  static double size[3][FB_MAX_LINEAR], same[3][FB_MAX_LINEAR];
  for (int k = 0; k < 8; k++) {
    const double tol = FBT_TOL(1e-11, 1e-3);
    const int large = k % 2;
    int n;
    linear_in_units(&one, same, bases[k / 2], 1.0, 1.0);
    n = one.n;
    linear_in_units(&other, size, bases[k / 2], large ? FBT_TOL(1e3, 1e2) : FBT_TOL(1e-3, 1e-2), large ? 0.125 : 8.0);
    FBT_BELOW(units_apart(other.A, one.A, size[0], size[0], n, n), tol);
    FBT_BELOW(units_apart(other.C, one.C, size[2], size[0], one.n_out, n), tol);
    FBT_BELOW(units_apart(other.B, one.B, size[0], size[1], n, one.n_in), tol);
    FBT_BELOW(units_apart(other.D, one.D, size[2], size[1], one.n_out, one.n_in), tol);
  }
}

/* E12.18: fb_spectrum_margin: whichever of the modes it is that damps least, that one is named; of two alike the
   first. */
TEST(margins_name_the_worst_mode_wherever_it_stands)
{
  for (int n = 1; n < 5; n++) {
    for (int worst = 0; worst < n; worst++) {
      for (int twin = worst; twin < n; twin++) {
        fb_real re[4] = {-FB_R(3.0), -FB_R(2.0), -FB_R(4.0), -FB_R(2.0)};
        int mode = -1;
        re[worst] = re[twin] = -FB_R(0.25);
        FBT_NEAR_ABS(fb_spectrum_margin(&mode, re, n), 0.25, 0.0);
        FBT_INT_EQ(mode, worst);
      }
    }
  }
}

/* E6.12, E7.2, E12.3: the blade of the NREL 5-MW turbine (nrel5mw_blade.csv, NREL/TP-500-38060; 49 stations, twisted):
   mass, first and second moment, and the clamped frequencies at rest and at 12.1 rpm against ElastoDyn's, which come
   from polynomials of one direction each and so lie somewhat higher. */
TEST(nrel_blade_has_the_published_figures)
{
  static const double figure[2][3] = {{0.682966, 1.096501, 1.986600},
                                      {0.734079, 1.122939, 2.043999}}; /* flap edge flap */
  static const double factor = 1.04536, length = 61.5;                 /* AdjBlMs */
  const fbt_table *table = fbt_reference("nrel5mw_blade.csv");
  double sum[3] = {0.0, 0.0, 0.0}, largest = 0.0;
  FBT_INT_EQ(table->rows, 49);
  uniform_line(length, 10, 0.0, 0.0, 0.0, 4);
  line.n_station = table->rows;
  line.position[0] = FB_R(1.5);
  for (int k = 0; k < table->rows; k++) {
    fb_section *s = &line.station[k];
    s->x = (fb_real)(fbt_value(table, k, "span_fraction") * length);
    s->twist = (fb_real)(fbt_value(table, k, "twist_deg") * pi / 180.0);
    s->mass = (fb_real)(fbt_value(table, k, "mass") * factor);
    s->EI_y = (fb_real)fbt_value(table, k, "EI_flap");
    s->EI_z = (fb_real)fbt_value(table, k, "EI_edge");
    s->GJ = (fb_real)fbt_value(table, k, "GJ");
    s->EA = (fb_real)fbt_value(table, k, "EA");
  }
  for (int node = 0; node < 17; node++) { /* ElastoDyn's own sums, 17 nodes in the middles of equal pieces */
    const double x = (node + 0.5) / 17.0 * length;
    fb_section s;
    beam.desc = line;
    fb_beam_section_eval(&beam, &s, (fb_real)x);
    for (int power = 0; power < 3; power++) {
      sum[power] += (double)s.mass * pow(x, power) * length / 17.0;
    }
  }
  FBT_NEAR_REL(sum[0], 17536.614, 1e-6);
  FBT_NEAR_REL(sum[1], 362132.653, 1e-6);
  keep.count[FB_KIND_AXIAL] = 1;
  level.effects = FB_EFFECTS_FULL;
  level.base = FB_BASE_PRESCRIBED;
  beam_body(&body, 0.0, NULL, NULL);
  FBT_NEAR_REL(beam.mass, 16844.752 * factor, FBT_TOL(1e-6, 1e-5));
  FBT_NEAR_REL(modes.rigid_mass[0], 16844.752 * factor, FBT_TOL(1e-6, 1e-5));
  FBT_NEAR_REL(modes.rigid_mass[4], 1.11816e7 * factor, 1e-3); /* trapezoids lie 6e-4 lower */
  FBT_NEAR_REL(shape.c[0] / shape.mass - FB_R(1.5), 20.5073, 1e-3);
  for (int run = 0; run < 2; run++) {
    fb_state state;
    fb_input input;
    memset(&input, 0, sizeof input);
    input.w[2] = (fb_real)(run * 12.1 * 2.0 * pi / 60.0);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_OK);
    FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, &spectrum, &state, &input), FB_OK);
    for (int k = 0; k < 3; k++) {
      const double ratio = (double)spectrum.im[k] / (2.0 * pi) / figure[run][k] - 1.0;
      largest = fmax(largest, fabs(ratio));
      FBT_BELOW(ratio, 0.0);
      FBT_BELOW(-0.03, ratio);
    }
  }
  fbt_figure("NREL 5-MW blade, flap, edge, flap at 0 and 12.1 rpm", "ElastoDyn", largest);
}

/* ---- a disk (4 kg, with the radii of gyration 0.15 m and 0.112 m on 0.6 m) that spins at the tip of a clamped
   shaft */

/* E12.3, E12.16: where shafts are so light, long and finely resolved that rounding takes the slow whirls away, the
   spectrum says so: each is within the error of a mode that is there, or the whole is refused. The lightest are beyond
   use. */
TEST(errors_of_spectra_are_told)
{
  int lost = 0, good = 0;
  for (int run = 0; run < 60; run++) {
    const double length = 0.06 * pow(10.0, run % 4), disk = 4.0, shaft = 0.4 * pow(10.0, -(run % FBT_TOL(9, 5))),
                 spin = 100.0 * (run % 7);
    double want[4];
    fb_status status;
    if (!shaft_with_disk(length, shaft, disk, spin, run / 15 * FBT_TOL(2, 0))) {
      continue;
    }
    whirls(want, length, disk, spin);
    memset(&spectrum, 0xff, sizeof spectrum);
    status = fb_system_spectrum_solve(&mechanism, part, &tree_work, &spectrum, &tree_state, &drive);
    if (status != FB_OK) {
      FBT_INT_EQ(status, FB_ERR_CONVERGENCE);
      FBT_TRUE(spectrum.n == -1); /* as before */
      lost++;
      continue;
    }
    for (int i = 0; i < 4; i++) {
      double best = HUGE_VAL, relative = 0.0;
      for (int k = 0; k < spectrum.n; k++) {
        const double apart = hypot((double)spectrum.re[k], (double)spectrum.im[k] - want[i]) -
                             want[i] * (shaft / disk + FBT_TOL(1e-11, 1e-3));
        if (apart / (double)spectrum.error[k] < best) {
          best = apart / (double)spectrum.error[k];
          relative = (double)spectrum.error[k] / want[i];
        }
      }
      FBT_BELOW(best, 20.0);
      good += relative < 1e-3;
      lost += relative > 0.1;
    }
  }
  FBT_TRUE(good > FBT_TOL(100, 20));
  FBT_TRUE(lost > 0);
}

/* Interface: what cannot be linearized is refused, the state kept. */
TEST(analysis_refuses_bad_input)
{
  static fb_linear linear;
  fb_linear_desc ports;
  fb_state state, kept;
  fb_input input;
  particle_on_springs(0.5, 4.0, 9.0, 0.0);
  memset(&input, 0, sizeof input);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  kept = state;
  FBT_INT_EQ(fb_body_trim(NULL, &state, &work, &input), FB_ERR_NULL);
  FBT_INT_EQ(fb_body_trim(&body, NULL, &work, &input), FB_ERR_NULL);
  FBT_INT_EQ(fb_body_trim(&body, &state, NULL, &input), FB_ERR_NULL);
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, NULL), FB_ERR_NULL);
  FBT_INT_EQ(fb_body_linearize(&body, &work, NULL, &state, &input, NULL), FB_ERR_NULL);
  FBT_INT_EQ(fb_body_linearize(&body, NULL, &linear, &state, &input, NULL), FB_ERR_NULL);
  input.n_load = 1;
  input.load[0].node = 99;
  linear.A[0] = FB_R(7.0);
  FBT_INT_EQ(fb_body_linearize(&body, &work, &linear, &state, &input, NULL), FB_ERR_CAPACITY);
  FBT_NEAR_ABS(linear.A[0], 7.0, 0.0);
  input.n_load = 0;
  memset(&ports, 0, sizeof ports);
  ports.n_in = FB_MAX_PORTS + 1;
  FBT_INT_EQ(fb_body_linearize(&body, &work, &linear, &state, &input, &ports), FB_ERR_CAPACITY);
  ports.n_in = 1;
  ports.in[0].axis = 3;
  FBT_INT_EQ(fb_body_linearize(&body, &work, &linear, &state, &input, &ports), FB_ERR_VALUE);
  ports.in[0].axis = 0;
  ports.in[0].node = 1;
  FBT_INT_EQ(fb_body_linearize(&body, &work, &linear, &state, &input, &ports), FB_ERR_CAPACITY);
  ports.in[0].kind = FB_PORT_RATE;
  FBT_INT_EQ(fb_body_linearize(&body, &work, &linear, &state, &input, &ports), FB_ERR_VALUE);
  ports.n_in = 0;
  ports.n_out = 1;
  ports.out[0].kind = FB_PORT_BASE_RATE;
  FBT_INT_EQ(fb_body_linearize(&body, &work, &linear, &state, &input, &ports), FB_ERR_VALUE);
  ports.out[0].kind = FB_PORT_COORDINATE; /* of joints */
  FBT_INT_EQ(fb_body_linearize(&body, &work, &linear, &state, &input, &ports), FB_ERR_VALUE);
  ports.out[0].kind = FB_PORT_RATE;
  ports.out[0].body = 1;
  FBT_INT_EQ(fb_body_linearize(&body, &work, &linear, &state, &input, &ports), FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, NULL, &state, &input), FB_ERR_NULL);
  FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, &spectrum, NULL, &input), FB_ERR_NULL);
  input.w[2] = (fb_real)NAN;
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_NOT_FINITE);
  body.base = FB_BASE_PINNED;
  input.w[2] = (fb_real)INFINITY;
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_NOT_FINITE);
  body.base = FB_BASE_PRESCRIBED;
  input.w[2] = FB_R(1.99); /* rests 49.6 m out: beyond the limit of 10 m */
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_RANGE);
  FBT_TRUE(memcmp(&state, &kept, sizeof state) == 0);
  state.q[0] = (fb_real)NAN;
  FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, &spectrum, &state, &input), FB_ERR_NOT_FINITE);
}

SUITE(analyse_body, RUN(margins_name_the_worst_mode_wherever_it_stands), RUN(linear_models_do_not_depend_on_units),
      RUN(spectrum_of_a_spinning_oscillator_is_closed_form), RUN(bases_that_move_move_the_state_of_rest),
      RUN(damped_modes_have_their_ratios), RUN(free_tops_nutate_as_euler_says),
      RUN(equal_inertias_spin_about_any_of_their_axes), RUN(a_weight_across_the_axis_is_no_rest),
      RUN(a_hinge_turns_what_spins_about_no_axis_of_its_own), RUN(damped_spinning_satellite_has_its_closed_form),
      RUN(linear_models_answer_as_the_body_does), RUN(linear_models_tell_how_a_state_moves_on),
      RUN(nrel_blade_has_the_published_figures), RUN(errors_of_spectra_are_told), RUN(analysis_refuses_bad_input))
