/* Section 12: steady states, linearization, complex modes: against characteristic polynomials in closed form, statics,
   the modes they are made of, and published frequencies of a rotor blade. */
#include "fbt.h"

#define EPS FBT_TOL(2.2204460492503131e-16, 1.19209290e-7)
static const double pi = 3.14159265358979323846;

static fb_shape shape;
static fb_body body;
static fb_body_work body_work;
static fb_analyse_work work;
static fb_spectrum spectrum;

static fb_beam_desc line;
static fb_beam beam;
static fb_modes modes;
static fb_modes_work modes_work;
static fb_modes_desc keep;
static fb_body_desc level;

/* A uniform beam and as many bending modes each way; whatever else is in `line`, `keep`, `level` comes after. */
static void uniform_line(double length, int n_element, double mass, double EI_y, double EI_z, int each_way)
{
  memset(&line, 0, sizeof line);
  memset(&keep, 0, sizeof keep);
  memset(&level, 0, sizeof level);
  line.length = (fb_real)length;
  line.n_element = n_element;
  line.n_station = 1;
  line.station[0].mass = (fb_real)mass;
  line.station[0].EI_y = (fb_real)EI_y;
  line.station[0].EI_z = (fb_real)EI_z;
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = each_way;
}

/* The body of that beam with a hub (mass 0: none) and node 1 at its tip. */
static void beam_body(fb_body *out, double hub, const fb_real center[3], const fb_real inertia[6])
{
  int node;
  FBT_INT_EQ(fb_beam_init(&beam, &line), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  if (hub > 0.0) {
    FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)hub, center, inertia), FB_OK);
  }
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, line.length), FB_OK);
  FBT_INT_EQ(node, 1);
  FBT_INT_EQ(fb_body_init(out, &body_work, &shape, &level), FB_OK);
}

/* A particle of 1 kg at (R, 0, 0) on springs k_x, k_y with dashpots, in a frame that turns about z. */
static void particle_on_springs(double R, double kx, double ky, double zeta)
{
  static fb_body_desc desc;
  const fb_real r[3] = {(fb_real)R, FB_R(0.0), FB_R(0.0)}, psi[6] = {FB_R(1.0), 0, 0, 0, FB_R(1.0), 0};
  memset(&desc, 0, sizeof desc);
  FBT_INT_EQ(fb_shape_init(&shape, 2), FB_OK);
  FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(1.0), r, psi, NULL), FB_OK);
  shape.K[0] = (fb_real)kx;
  shape.K[3] = (fb_real)ky;
  desc.effects = FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA | FB_EFFECT_DAMPING;
  desc.base = FB_BASE_PRESCRIBED;
  desc.zeta[0] = desc.zeta[1] = (fb_real)zeta;
  desc.deflection_limit = FB_R(10.0);
  desc.allow_split_effects = 1; /* a particle has no foreshortening */
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
}

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
    FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &body, &state, &input), FB_OK);
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

/* E12.2: what moves the base as an input: the state of rest q = w^2 R/(k_x - w^2) + w v_y/(k_x - w^2) of that particle, of
   which pi = (v_x, w (R + q) + v_y), follows v and w; A dx + B du = 0. The force on it as an input does so, too. */
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
  FBT_INT_EQ(fb_body_linearize(&body, &linear, &work, &state, &input, &ports), FB_OK);
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
  FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &body, &state, &input), FB_OK);
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
    FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &body, &state, &input), FB_OK);
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
   though at this instant nothing turns it: in space a torque does so, too, in the body it goes round with it. In every unit
   of length alike, and what is off by rounding is along. */
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
      FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), what % 2 || what == 6 ? FB_OK : FB_ERR_KIND);
    }
  }
}

/* E12.1: a body that turns on a hinge about no principal axis rests: the hinge bears what turns its angular momentum, and
   a torque across that goes round with it; not one about the hinge. */
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
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), run == 2 ? FB_ERR_KIND : FB_OK);
  }
}

/* E12.1: about any axis in the span of equal inertias a body spins freely, so it does about the one that is wanted: a
   sphere about all, a disc about all in its plane; from other directions about the nearest of them, or about its own. */
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
    const double part[3] = {w[0] * own[0], w[1] * own[1], w[2] * own[2]};
    const double stretch =
        sqrt((w[0] * w[0] + w[1] * w[1] + w[2] * w[2]) / (part[0] * part[0] + part[1] * part[1] + part[2] * part[2]));
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
    FBT_INT_EQ(fb_body_motion(&body, &motion, &state, &input), FB_OK);
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(motion.w[i], stretch * part[i], FBT_TOL(1e-13, 1e-5));
    }
  }
}

typedef struct number { /* complex */
  double re, im;
} number;

static number times(number a, number b)
{
  const number c = {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
  return c;
}

static number plus(number a, double s, number b)
{
  const number c = {a.re + s * b.re, a.im + s * b.im};
  return c;
}

/* E12.1 to E12.3: a free axisymmetric body (A, A, C) that spins about z and carries a nutation damper: a particle at R on
   the x axis, sprung and damped along z. Euler's equations and the particle's, linear in w_1, w_2 and its z, mu the
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
    FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &body, &state, &input), FB_OK);
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

/* x on by dt along x' = A x + B u, by rk4. */
static void linear_step(double *x, const fb_linear *linear, const double *u, double dt)
{
  static const double at[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
  double k[FB_MAX_LINEAR] = {0}, half[FB_MAX_LINEAR], sum[FB_MAX_LINEAR] = {0};
  for (int stage = 0; stage < 4; stage++) {
    for (int i = 0; i < linear->n; i++) {
      half[i] = x[i] + at[stage] * dt * k[i];
    }
    for (int i = 0; i < linear->n; i++) {
      k[i] = 0.0;
      for (int j = 0; j < linear->n_in; j++) {
        k[i] += (double)linear->B[i * linear->n_in + j] * u[j];
      }
      for (int j = 0; j < linear->n; j++) {
        k[i] += (double)linear->A[i * linear->n + j] * half[j];
      }
      sum[i] += weight[stage] * k[i];
    }
  }
  for (int i = 0; i < linear->n; i++) {
    x[i] += dt * sum[i];
  }
}

/* y_k = C x + D u */
static double linear_output(const fb_linear *linear, const double *x, const double *u, int k)
{
  double y = 0.0;
  for (int j = 0; j < linear->n; j++) {
    y += (double)linear->C[k * linear->n + j] * x[j];
  }
  for (int j = 0; j < linear->n_in; j++) {
    y += (double)linear->D[k * linear->n_in + j] * u[j];
  }
  return y;
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
  FBT_INT_EQ(fb_body_linearize(&body, &linear, &work, &steady, &input, &ports), FB_OK);
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
    FBT_INT_EQ(fb_body_motion(&body, &motion, &state, &loads), FB_OK);
    for (int k = 0; k < 8; k++) {
      fb_node_motion at;
      fb_imu imu;
      double y;
      FBT_INT_EQ(fb_body_node_motion(&body, &at, &state, &motion, ports.out[k].node), FB_OK);
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

/* Largest |a_ij s_j/s_i - b_ij| of n x m, in parts of the largest element of the row and of a thousandth of that of all: a
   in other units, s those of rows and columns. */
static double units_apart(const fb_real *a, const fb_real *b, const double *row, const double *column, int n, int m)
{
  double apart = 0.0;
  for (int i = 0; i < n; i++) {
    double worst = 0.0;
    for (int j = 0; j < m; j++) {
      worst = fmax(worst, fabs((double)a[i * m + j] * column[j] / row[i] - (double)b[i * m + j]));
    }
    apart = fmax(apart, worst / (fbt_largest(b + i * m, m) + 1e-3 * fbt_largest(b, n * m)));
  }
  return apart;
}

static const fb_linear_desc all_ports = {4,
                                         6,
                                         {{FB_PORT_FORCE, 0, 1, 1},
                                          {FB_PORT_TORQUE, 0, 0, 2},
                                          {FB_PORT_BASE_VELOCITY, 0, 0, 0},
                                          {FB_PORT_BASE_RATE, 0, 0, 1}},
                                         {{FB_PORT_DISPLACEMENT, 0, 1, 1},
                                          {FB_PORT_ROTATION, 0, 1, 2},
                                          {FB_PORT_RATE, 0, 0, 2},
                                          {FB_PORT_ACCELERATION, 0, 1, 1},
                                          {FB_PORT_RATE, 0, 1, 0},
                                          {FB_PORT_ACCELERATION, 0, 0, 0}}};

/* The linear model of a deflected beam on a hub that turns, drifts and hangs in gravity, in units of u meters, m kilograms,
   and in size those of x, of the inputs and of the outputs. */
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
  FBT_INT_EQ(fb_body_linearize(&body, linear, &work, &state, &input, &ports), FB_OK);
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

/* E12.2: the linear model is the same in every unit of length and of mass: of rates of momenta and pose, of loads and motions
   of the base as inputs, of what gyros and accelerometers read; every base. */
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

/* fb_spectrum_margin: whichever of the modes it is that damps least, that one is named; of two alike the first. */
TEST(margins_name_the_worst_mode_wherever_it_stands)
{
  for (int n = 1; n < 5; n++) {
    for (int worst = 0; worst < n; worst++) {
      for (int twin = worst; twin < n; twin++) {
        fb_real re[4] = {-FB_R(3.0), -FB_R(2.0), -FB_R(4.0), -FB_R(2.0)};
        int mode = -1;
        re[worst] = re[twin] = -FB_R(0.25);
        FBT_NEAR_ABS(fb_spectrum_margin(re, &mode, n), 0.25, 0.0);
        FBT_INT_EQ(mode, worst);
      }
    }
  }
}

/* E12.6, E12.7: limits, advised steps and damping ratios follow the unit of time: modes slower by 2^20 want steps longer by
   as much, fast, slow, damped, stiff and still ones; what stands still has no damping. Without amplitudes they are 1. */
TEST(advised_steps_follow_the_unit_of_time)
{
  static const double re[4] = {-0.3, -40.0, 0.0, -0.02}, im[4] = {5.0, 0.0, 0.0, 0.7};
  static const fb_scheme scheme[3] = {FB_SCHEME_RK4, FB_SCHEME_MIDPOINT, FB_SCHEME_SDIRK};
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
      limit[unit] = fmin((double)fb_spectrum_limit(&spectrum, scheme[k % 3]) / t, 1e10);
      step[unit] =
          (double)fb_spectrum_step(&spectrum, scheme[k % 3], NULL, (fb_real)(10.0 * t), (fb_real)accuracy[k / 3]) / t;
      FBT_NEAR_REL(limit[unit], limit[0], 8.0 * EPS);
      FBT_NEAR_REL(step[unit], step[0], 64.0 * EPS);
      FBT_TRUE(step[unit] > 0.0);
      FBT_NEAR_ABS(fb_spectrum_step(&spectrum, scheme[k % 3], one, (fb_real)(10.0 * t), (fb_real)accuracy[k / 3]),
                   step[unit] * t, 0.0);
    }
  }
}

/* E12.7: each of T/dt steps errs by |G - exp|(i omega dt): a tolerance of their sum gives that step, short or long. */
TEST(advised_steps_are_those_whose_errors_add_up)
{
  static const fb_scheme scheme[3] = {FB_SCHEME_RK4, FB_SCHEME_MIDPOINT, FB_SCHEME_SDIRK};
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
        fb_spectrum_step(&spectrum, scheme[k / 5], amplitude, (fb_real)T, (fb_real)(3.0 * error * T * omega / d)),
        d / omega, 0.01);
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
    fb_beam_section(&s, &beam, (fb_real)x);
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
    FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &body, &state, &input), FB_OK);
    for (int k = 0; k < 3; k++) {
      const double ratio = (double)spectrum.im[k] / (2.0 * pi) / figure[run][k] - 1.0;
      largest = fmax(largest, fabs(ratio));
      FBT_BELOW(ratio, 0.0);
      FBT_BELOW(-0.03, ratio);
    }
  }
  fbt_figure("NREL 5-MW blade, flap, edge, flap at 0 and 12.1 rpm", "ElastoDyn", largest);
}

/* E12.6: at 0.99 of the limit a damped, spinning oscillator comes to rest, at 1.01 it runs away; where the limit is that of
   the real axis (2.785), of the imaginary one (2.828) and between. */
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
      FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &body, &state, &input), FB_OK);
      limit = (double)fb_spectrum_limit(&spectrum, FB_SCHEME_RK4);
      state.q[1] = FB_R(1e-3);
      for (int i = 0; i < 4000 && status == FB_OK; i++) {
        status = fb_rk4_step(&body, &state, &rk4, &input, &input, &input, (fb_real)(limit * (k ? 1.01 : 0.99)));
      }
      after = fabs((double)state.q[1]) + fabs((double)state.pi[1]) / 30.0;
      FBT_TRUE(k ? status == FB_ERR_RANGE || after > 1.0 : after < 1e-3);
    }
    FBT_TRUE(fb_spectrum_limit(&spectrum, FB_SCHEME_SDIRK) > FB_R(1e6));
  }
}

/* E12.6: a mode that grows, by rounding or slowly of itself, limits the step as one that just swings: at 2 sqrt 2 of rk4's
   imaginary axis; one that only grows does not. What makes no sense has no step. */
TEST(step_limits_hold_for_modes_that_grow)
{
  static const double growth[3] = {1e-12, 1e-6, 0.2};
  memset(&spectrum, 0, sizeof spectrum);
  spectrum.n = 2;
  for (int run = 0; run < 3; run++) {
    spectrum.re[0] = FB_R(5.0);
    spectrum.re[1] = (fb_real)(growth[run] * 300.0);
    spectrum.im[1] = FB_R(300.0);
    FBT_NEAR_REL(fb_spectrum_limit(&spectrum, FB_SCHEME_RK4), 2.0 * sqrt(2.0) / 300.0, FBT_TOL(1e-9, 1e-3));
  }
  FBT_NEAR_ABS(fb_spectrum_limit(NULL, FB_SCHEME_RK4), 0.0, 0.0);
  FBT_NEAR_ABS(fb_spectrum_limit(&spectrum, FB_SCHEME_EXPONENTIAL), 0.0, 0.0);
  FBT_NEAR_ABS(fb_spectrum_damping(&spectrum, 0), -1.0, 0.0);
  FBT_NEAR_ABS(fb_spectrum_damping(&spectrum, 2), 0.0, 0.0);
  FBT_NEAR_ABS(fb_spectrum_damping(&spectrum, -1), 0.0, 0.0);
  FBT_NEAR_ABS(fb_spectrum_damping(NULL, 0), 0.0, 0.0);
  for (int part = 0; part < 2; part++) {
    (part ? spectrum.im : spectrum.re)[0] = (fb_real)NAN;
    FBT_NEAR_ABS(fb_spectrum_limit(&spectrum, FB_SCHEME_RK4), 0.0, 0.0);
    FBT_NEAR_ABS(fb_spectrum_step(&spectrum, FB_SCHEME_SDIRK, NULL, FB_R(1.0), FB_R(0.1)), 0.0, 0.0);
    spectrum.re[0] = -FB_R(1.0);
  }
}

static void step_on(fb_state *state, fb_scheme scheme, const fb_input *input, double dt)
{
  static fb_rk4_work rk4;
  static fb_implicit_work implicit;
  const fb_real h = (fb_real)dt;
  FBT_INT_EQ(scheme == FB_SCHEME_RK4        ? fb_rk4_step(&body, state, &rk4, input, input, input, h)
             : scheme == FB_SCHEME_MIDPOINT ? fb_midpoint_step(&body, state, &implicit, input, h, 0)
                                            : fb_sdirk_step(&body, state, &implicit, input, input, h, 0),
             FB_OK);
}

/* Largest error of the oscillator's two coordinates together, of sizes 1 and 0.3 to begin with, over that many steps:
   against the exact motion (its modes at rest). */
static double oscillator_error(fb_scheme scheme, double zeta, double dt, int steps)
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
    step_on(&state, scheme, &input, dt);
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
static double advised_step(fb_scheme scheme, double zeta, double duration, double tolerance)
{
  const fb_real amplitude[4] = {FB_R(1.0), FB_R(0.3), 0, 0};
  fb_state state;
  fb_input input;
  particle_on_springs(0.0, 4.0, 90.0, zeta);
  body.allow_long_step = 1;
  memset(&input, 0, sizeof input);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &body, &state, &input), FB_OK);
  return (double)fb_spectrum_step(&spectrum, scheme, amplitude, (fb_real)duration, (fb_real)tolerance);
}

/* E12.7: steps by the advice miss a swinging oscillator's exact motion by what was wanted, within a factor of 3. */
TEST(advised_steps_err_as_wanted)
{
  static const double wanted[3] = {1e-1, 1e-2, 1e-3};
  for (int run = 0; run < 18; run++) {
    const fb_scheme scheme = (fb_scheme)(run % 3);
    const double zeta = run / 3 % 2 ? 0.02 : 0.0, duration = 20.0, tolerance = wanted[run / 6];
    const double dt = advised_step(scheme, zeta, duration, tolerance);
    double error;
    FBT_TRUE(dt > 0.0);
    error = oscillator_error(scheme, zeta, dt, (int)ceil(duration / dt));
    FBT_BELOW(error, 3.0 * tolerance);
    FBT_BELOW(tolerance / 3.0, error);
  }
  FBT_NEAR_ABS(fb_spectrum_step(&spectrum, (fb_scheme)3, NULL, FB_R(1.0), FB_R(0.1)), 0.0, 0.0);
  FBT_NEAR_ABS(fb_spectrum_step(&spectrum, FB_SCHEME_RK4, NULL, FB_R(0.0), FB_R(0.1)), 0.0, 0.0);
  FBT_NEAR_ABS(fb_spectrum_step(&spectrum, FB_SCHEME_RK4, NULL, FB_R(1.0), (fb_real)NAN), 0.0, 0.0);
}

/* E12.7: over a time that outlasts the motion by far the advised steps still resolve it while it lasts: they do not
   grow with the duration, and err in the first seconds by what was wanted. */
TEST(advice_resolves_modes_that_die_out)
{
  for (int run = 0; run < 6; run++) {
    const fb_scheme scheme = (fb_scheme)(run % 3);
    const double zeta = 0.3, tolerance = run / 3 ? 1e-2 : 1e-1;
    const double dt = advised_step(scheme, zeta, 1e6, tolerance);
    double error;
    FBT_NEAR_REL(dt, advised_step(scheme, zeta, 1e2, tolerance), FBT_TOL(1e-9, 1e-4));
    FBT_BELOW(dt, 1.0);
    error = oscillator_error(scheme, zeta, dt, (int)ceil(20.0 / dt));
    FBT_BELOW(error, 3.0 * tolerance);
    FBT_BELOW(tolerance / 3.0, error);
  }
}

/* E12.7: the fastest mode of a stiff spring with a stiff dashpot, exp(l t) with l = -9899/s, has gone before a step of the
   implicit schemes ends: what is left of it then counts (the midpoint rule turns its sign and keeps nearly all). The
   advice holds what is wanted, and where it is less than all of the duration, by no more than a factor of 5. */
TEST(advised_steps_bear_stiff_damping)
{
  for (int run = 0; run < 9; run++) {
    const fb_scheme scheme = (fb_scheme)(run % 3);
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
    FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &body, &state, &input), FB_OK);
    FBT_INT_EQ(spectrum.n, 4);
    FBT_NEAR_REL(spectrum.re[3], rate, FBT_TOL(1e-8, 1e-2));
    dt = (double)fb_spectrum_step(&spectrum, scheme, amplitude, (fb_real)duration, (fb_real)(1e-3 * tolerance));
    FBT_TRUE(dt > 0.0);
    state.q[1] = FB_R(1e-3);
    state.pi[1] = (fb_real)(1e-3 * rate);
    for (int i = 1; i <= (int)ceil(duration / dt); i++) {
      step_on(&state, scheme, &input, dt);
      most = fmax(most, fabs(1e3 * (double)state.q[1] - exp(rate * i * dt)));
    }
    FBT_BELOW(most, 3.0 * tolerance);
    FBT_TRUE(dt > 0.99 * duration || most > tolerance / 5.0);
  }
}

/* ---- systems */

static fb_body part[FB_MAX_BODIES];
static fb_system_desc tree;
static fb_system mechanism;
static fb_system_analyse_work tree_work;
static fb_system_state tree_state;
static fb_system_input drive;
static fb_link_motion start[FB_MAX_BODIES];

static void fresh(void)
{
  memset(&tree, 0, sizeof tree);
  memset(&drive, 0, sizeof drive);
  memset(start, 0, sizeof start);
}

/* Model k: a rigid body with its mass center on x, inertia about the origin. */
static void rigid_part(int k, double mass, double c, double jx, double jy, double jz, double gravity)
{
  static fb_body_desc desc;
  const double off = mass * c * c;
  const fb_real center[3] = {(fb_real)c, 0, 0}, J[6] = {(fb_real)jx, (fb_real)(jy - off), (fb_real)(jz - off), 0, 0, 0};
  const fb_real tip[3] = {(fb_real)(2.0 * c), 0, 0};
  int node;
  memset(&desc, 0, sizeof desc);
  desc.base = FB_BASE_PRESCRIBED;
  desc.effects = gravity != 0.0 ? (unsigned)FB_EFFECT_GRAVITY : 0u;
  desc.gravity[0] = (fb_real)gravity;
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)mass, center, J), FB_OK);
  FBT_INT_EQ(fb_shape_add_node(&shape, &node, tip, NULL, NULL), FB_OK);
  FBT_INT_EQ(fb_body_init(&part[k], &body_work, &shape, &desc), FB_OK);
}

/* Model k: a hub and a beam along x, node 1 its tip, n bending modes each way. */
static void flexible_part(int k, double length, int n, fb_base base, unsigned effects)
{
  const fb_real center[3] = {FB_R(0.1), 0, 0}, J[6] = {FB_R(0.8), FB_R(0.5), FB_R(0.9), 0, 0, 0};
  uniform_line(length, 6, 0.5, 40.0, 60.0, n);
  level.effects = effects;
  level.base = base;
  for (int a = 0; a < 2 * n; a++) {
    level.zeta[a] = FB_R(0.02);
  }
  beam_body(&part[k], 2.0, center, J);
}

static fb_joint_desc *hang(int k, int model, fb_joint_kind kind, int parent)
{
  fb_joint_desc *const j = &tree.joint[k];
  tree.n_body = k + 1;
  tree.model[k] = model;
  j->kind = kind;
  j->parent = parent;
  return j;
}

static void build(void)
{
  FBT_INT_EQ(fb_system_init(&mechanism, &tree_work.system, part, FB_MAX_BODIES, &tree), FB_OK);
  FBT_INT_EQ(fb_system_state_init(&mechanism, part, &tree_work.system, &tree_state, start, &drive), FB_OK);
}

static void trim_and_modes(void)
{
  FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), FB_OK);
  FBT_INT_EQ(fb_system_spectrum(&spectrum, &tree_work, &mechanism, part, &tree_state, &drive), FB_OK);
  FBT_BELOW((double)tree_work.common.linear.error, FBT_TOL(1e-10, 1e-3)); /* as examples/MODELS.md says */
}

/* A hub that a motor turns about z at Omega, its hinge e out along x. */
static void rotor(double Omega)
{
  fresh();
  rigid_part(0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.0);
  hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND)->mode[0] = FB_AXIS_PRESCRIBED;
  drive.drive[0].rate[0] = (fb_real)Omega;
}

static void frame_turn(fb_real quat[4], double x, double y, double z)
{
  const fb_real phi[3] = {(fb_real)x, (fb_real)y, (fb_real)z};
  fb_quat_from_rotvec(quat, phi);
}

/* E12.8 to E12.10: a rigid blade, a lamina in the rotor's plane (J_z = J_x + J_y), on a ball joint with springs k: its
   potential -Omega^2 I_spin/2 gives, uncoupled, lag^2 = Omega^2 e m c/J_z + k/J_z, flap^2 = Omega^2 (1 + e m c/J_y) +
   k/J_y, pitch^2 = Omega^2 + k/J_x. On a universal joint there is no pitch, on a hinge no lag. From a guess off it the
   trim finds the blade straight. */
TEST(hinged_blades_flap_and_lag_in_closed_form)
{
  static const fb_joint_kind kinds[3] = {FB_JOINT_REVOLUTE, FB_JOINT_UNIVERSAL, FB_JOINT_SPHERICAL};
  double largest = 0.0;
  for (int run = 0; run < 12; run++) {
    const fb_joint_kind kind = kinds[run % 3];
    const double Omega = 3.0 + run, e = 0.1 + 0.05 * run, m = 2.0, c = 0.7, k = run / 3 % 2 ? 20.0 : 0.0;
    const double jx = 0.05, jy = 1.3, jz = jx + jy, emc = e * m * c, square = Omega * Omega;
    const double lag = sqrt((square * emc + k) / jz), flap = sqrt(square + (square * emc + k) / jy);
    const double pitch = sqrt(square + k / jx);
    double want[3] = {lag, flap, pitch};
    int n = 3;
    fb_joint_desc *hinge;
    rotor(Omega);
    rigid_part(1, m, c, jx, jy, jz, 0.0);
    hinge = hang(1, 1, kind, 0);
    hinge->position[0] = (fb_real)e;
    hinge->stiffness[0] = hinge->stiffness[1] = (fb_real)k;
    if (kind == FB_JOINT_REVOLUTE) { /* z of the joint along -y */
      frame_turn(hinge->attitude, pi / 2, 0.0, 0.0);
      frame_turn(hinge->child_attitude, pi / 2, 0.0, 0.0);
      want[0] = flap;
      n = 1;
    } else if (kind == FB_JOINT_UNIVERSAL) { /* z up, x along -y */
      frame_turn(hinge->attitude, 0.0, 0.0, -pi / 2);
      frame_turn(hinge->child_attitude, 0.0, 0.0, -pi / 2);
      n = 2;
    }
    start[1].value[0] = FB_R(0.2);
    start[1].value[1] = kind == FB_JOINT_UNIVERSAL ? -FB_R(0.1) : FB_R(0.0);
    frame_turn(start[1].quat, 0.1, -0.2, 0.05);
    build();
    trim_and_modes();
    if (kind == FB_JOINT_SPHERICAL) {
      FBT_NEAR_ABS(tree_state.link[1].quat[0], 1.0, 8.0 * EPS);
    } else {
      FBT_NEAR_ABS(tree_state.link[1].x[0], 0.0, 64.0 * EPS);
    }
    FBT_INT_EQ(spectrum.n, n);
    if (want[1] > want[2] && n == 3) { /* ascending */
      want[1] = pitch;
      want[2] = flap;
    }
    for (int i = 0; i < n && i < spectrum.n; i++) {
      FBT_NEAR_REL(spectrum.im[i], want[i], FBT_TOL(1e-10, 1e-3));
      FBT_NEAR_ABS(spectrum.re[i], 0.0, FBT_TOL(1e-10, 1e-3) * Omega);
      largest = fmax(largest, fabs((double)spectrum.im[i] / want[i] - 1.0));
    }
  }
  fbt_figure("rigid blade on hinges, flap, lag and pitch", "closed form", largest);
}

/* E12.8, E12.9: a constant moment M about a flap hinge on the axis cones the blade by sin 2 beta = 2 M/(Omega^2 (J_z -
   J_x)); about that it swings with Omega^2 (J_z - J_x) cos 2 beta/J_y. Beyond 45 degrees there is no equilibrium. */
TEST(blades_cone_under_a_moment)
{
  for (int run = 1; run < 7; run++) {
    const double Omega = 4.0, jx = 0.1, jy = 1.25, jz = 1.2, hold = Omega * Omega * (jz - jx),
                 M = 0.16 * run * hold / 2.0;
    const double beta = 0.5 * asin(0.16 * run), omega = sqrt(hold * cos(2.0 * beta) / jy);
    fb_joint_desc *hinge;
    rotor(Omega);
    rigid_part(1, 2.0, 0.7, jx, jy, jz, 0.0);
    hinge = hang(1, 1, FB_JOINT_REVOLUTE, 0);
    frame_turn(hinge->attitude, pi / 2, 0.0, 0.0);
    frame_turn(hinge->child_attitude, pi / 2, 0.0, 0.0);
    drive.drive[1].torque[0] = (fb_real)M;
    build();
    drive.drive[0].value[0] = FB_R(0.3); /* the motor is elsewhere by now */
    trim_and_modes();
    FBT_NEAR_ABS(tree_state.link[0].x[0], 0.3, EPS);
    FBT_NEAR_ABS(tree_state.link[1].x[0], beta, FBT_TOL(1e-13, 1e-5));
    FBT_NEAR_REL(spectrum.im[0], omega, FBT_TOL(1e-11, 1e-4));
  }
  {
    const fb_system_state before = tree_state;
    fb_status status;
    drive.drive[1].torque[0] = FB_R(10.0);
    status = fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive);
    FBT_TRUE(status == FB_ERR_CONVERGENCE || status == FB_ERR_SINGULAR || status == FB_ERR_NOT_FINITE);
    FBT_TRUE(memcmp(&before, &tree_state, sizeof before) == 0);
  }
}

/* A hub that spins about z with two flexible booms side by side on sprung hinges, and a rod between their tips. */
static void boom_loop(fb_axis_mode base)
{
  fb_joint_desc *j;
  fresh();
  rigid_part(0, 5.0, 0.0, 4.0, 4.0, 4.2, 0.0);
  flexible_part(1, 0.7, 1, FB_BASE_PRESCRIBED, FB_EFFECTS_FULL | FB_EFFECT_DAMPING);
  rigid_part(2, 0.8, 0.35, 0.02, 0.14, 0.14, 0.0);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND)->mode[0] = base;
  for (int k = 1; k <= 3; k += 2) {
    j = hang(k, 1, FB_JOINT_REVOLUTE, 0);
    j->position[0] = FB_R(0.4);
    j->position[1] = k == 1 ? -FB_R(0.45) : FB_R(0.45);
    if (k == 1) { /* bodies come in their order */
      j->stiffness[0] = FB_R(30.0);
      j->damping[0] = FB_R(0.3);
      hang(2, 2, FB_JOINT_REVOLUTE, 1)->parent_node = 1;
    }
  }
  tree.n_loop = 1;
  j = &tree.loop[0];
  j->kind = FB_JOINT_SPHERICAL;
  j->parent = 2;
  j->child = 3;
  j->parent_node = j->child_node = 1;
  start[1].value[0] = FB_R(0.1);
  start[2].value[0] = FB_R(1.45);
  start[3].value[0] = -FB_R(0.1);
  drive.drive[0].rate[5] = FB_R(2.0);
}

/* E12.1, E12.8: a free, pinned or hinged body rests where what acts on it is in balance: a beam that hangs from its hinge,
   straight, or hovers by a force and a torque on its hub, bent as one whose hub is held. Gravity or thrust alone leaves
   no state of rest, nor do wheels with momentum across the spin but under a torque that turns it; as a body and as what hangs on a free joint. */
TEST(bases_that_are_pushed_have_no_state_of_rest)
{
  const fb_real center[3] = {0}, J[6] = {FB_R(0.8), FB_R(0.5), FB_R(0.9), 0, 0, 0};
  fb_real sag[4] = {0};
  fb_motion held;
  for (int base = 0; base < 4; base++) {
    fb_state state, before;
    fb_input input;
    memset(&input, 0, sizeof input);
    uniform_line(2.0, 6, 0.5, 40.0, 60.0, 2);
    level.effects = FB_EFFECTS_FULL | FB_EFFECT_GRAVITY;
    level.gravity[1] = -FB_R(9.81);
    level.base = base == 0   ? FB_BASE_PRESCRIBED
                 : base == 1 ? FB_BASE_PINNED
                 : base == 2 ? FB_BASE_HINGED
                             : FB_BASE_FREE;
    beam_body(&body, 2.0, center, J);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    before = state;
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), base ? FB_ERR_KIND : FB_OK);
    if (base == 0) {
      memcpy(sag, state.q, sizeof sag);
      FBT_INT_EQ(fb_body_motion(&body, &held, &state, &input), FB_OK);
      FBT_TRUE(fbt_largest(sag, 4) > 0.01);
      continue;
    }
    FBT_TRUE(memcmp(&state, &before, sizeof state) == 0);
    frame_turn(state.quat, 0.0, 0.0, -pi / 2); /* downwards */
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), base == 3 ? FB_ERR_KIND : FB_OK);
    FBT_BELOW(fbt_largest(state.q, 4), FBT_TOL(1e-12, 1e-6));
    input.w[2] = FB_R(0.1); /* not for long */
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_KIND);
    input.w[2] = FB_R(0.0);
    state = before;
    input.n_load = 1;
    input.load[0].axes = FB_AXES_BODY;
    memcpy(input.load[0].force, held.reaction_force, sizeof held.reaction_force);
    memcpy(input.load[0].torque, held.reaction_torque, sizeof held.reaction_torque);
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_OK);
    FBT_BELOW(fbt_difference(state.q, sag, 4), FBT_TOL(1e-9, 1e-5));
    input.load[0].torque[2] = FB_R(0.0);
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_KIND);
  }
  boom_loop(FB_AXIS_FREE); /* at rest it is so to rounding: springs press on the loop */
  drive.drive[0].rate[5] = FB_R(0.0);
  build();
  FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), FB_OK);
  for (int run = 0; run < 5; run++) { /* a wheel along or across; a push; w x h, which turns the wheel across */
    fb_joint_desc *wheel;
    fb_system_state before;
    fresh();
    rigid_part(0, 8.0, 0.0, 3.0, 4.0, 6.0, 0.0);
    rigid_part(1, 1.0, 0.0, 0.1, 0.1, 0.2, 0.0);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND);
    wheel = hang(1, 1, FB_JOINT_REVOLUTE, 0);
    wheel->mode[0] = FB_AXIS_PRESCRIBED;
    frame_turn(wheel->attitude, run % 3 == 1 ? pi / 2 : 0.0, 0.0, 0.0);
    drive.drive[0].rate[5] = run == 3 ? FB_R(0.0) : FB_R(0.7);
    drive.drive[1].rate[0] = FB_R(20.0);
    drive.n_load = run >= 2;
    drive.load[0].load.axes = FB_AXES_BODY;
    (run % 2 ? drive.load[0].load.force : drive.load[0].load.torque)[0] = run == 4 ? FB_R(2.8) : FB_R(0.01);
    build();
    before = tree_state;
    FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), run % 4 ? FB_ERR_KIND : FB_OK);
    if (run % 4) {
      FBT_INT_EQ(tree_work.system.joint, 0);
      FBT_TRUE(memcmp(&before, &tree_state, sizeof before) == 0);
    }
  }
}

/* E12.8 to E12.10: a double pendulum of equal particles swings about its hanging position, found from one aside, with
   omega^2 = (2 -+ sqrt 2) g/l, the lower particle by +-sqrt 2 of the upper; by the dense method, too. */
TEST(double_pendulum_swings_in_closed_form)
{
  for (int run = 0; run < 2; run++) {
    const double g = 9.81, l = 0.6, m = 1.5, I = m * l * l;
    fresh();
    rigid_part(0, m, l, 0.0, I, I, g);
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND);
    hang(1, 0, FB_JOINT_REVOLUTE, 0)->position[0] = (fb_real)l;
    tree.method = run ? FB_METHOD_DENSE : FB_METHOD_RECURSIVE;
    start[0].value[0] = FB_R(0.5);
    start[1].value[0] = -FB_R(0.4);
    start[0].speed[0] = FB_R(0.3);
    build();
    trim_and_modes();
    FBT_NEAR_ABS(tree_state.link[0].x[0], 0.0, 64.0 * EPS);
    FBT_NEAR_ABS(tree_state.link[1].x[0], 0.0, 64.0 * EPS);
    FBT_NEAR_ABS(tree_state.link[0].p[0], 0.0, EPS);
    FBT_INT_EQ(spectrum.n, 2);
    for (int k = 0; k < 2; k++) {
      const double sign = k ? -1.0 : 1.0;
      const number upper = {(double)spectrum.shape_re[2 * k], (double)spectrum.shape_im[2 * k]};
      const number joint = {(double)spectrum.shape_re[2 * k + 1], (double)spectrum.shape_im[2 * k + 1]};
      const number miss = plus(joint, 1.0 - sign * sqrt(2.0), upper); /* lower = upper + joint = +-sqrt 2 upper */
      FBT_NEAR_REL(spectrum.im[k], sqrt((2.0 - sign * sqrt(2.0)) * g / l), FBT_TOL(1e-11, 1e-4));
      FBT_BELOW(hypot(miss.re, miss.im) / hypot(upper.re, upper.im), FBT_TOL(1e-10, 1e-3));
    }
  }
}

/* E12.3, E12.10: two forces F that pull a free body apart at its ends, a distance l from its center, and stay along x of
   inertial axes turn it back with 2 F l: omega^2 = 2 F l/J about y and about z. As a body and as a system of one. */
TEST(opposite_pulls_hold_a_free_body)
{
  const double F = 3.0, l = 0.8, J_y = 0.5, J_z = 0.9;
  const fb_real center[3] = {0}, J[6] = {FB_R(0.7), (fb_real)J_y, (fb_real)J_z, 0, 0, 0};
  fb_state state;
  fb_input input;
  fresh();
  memset(&level, 0, sizeof level);
  memset(&input, 0, sizeof input);
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(2.0), center, J), FB_OK);
  for (int k = 0; k < 2; k++) {
    const fb_real end[3] = {(fb_real)(k ? -l : l), 0, 0};
    int node;
    FBT_INT_EQ(fb_shape_add_node(&shape, &node, end, NULL, NULL), FB_OK);
    input.load[k].node = node;
    input.load[k].force[0] = (fb_real)(k ? -F : F);
    drive.load[k].load = input.load[k];
  }
  input.n_load = drive.n_load = 2;
  FBT_INT_EQ(fb_body_init(&part[0], &body_work, &shape, &level), FB_OK);
  FBT_INT_EQ(fb_state_init(&part[0], &state), FB_OK);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND);
  build();
  for (int system = 0; system < 2; system++) {
    int swings = 0;
    if (system) {
      FBT_INT_EQ(fb_system_spectrum(&spectrum, &tree_work, &mechanism, part, &tree_state, &drive), FB_OK);
    } else {
      FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &part[0], &state, &input), FB_OK);
    }
    for (int k = 0; k < spectrum.n; k++) {
      if (spectrum.im[k] > FB_R(0.1)) { /* the others drift */
        FBT_NEAR_REL(spectrum.im[k], sqrt(2.0 * F * l / (swings ? J_y : J_z)), FBT_TOL(1e-9, 1e-3));
        swings++;
      }
    }
    FBT_INT_EQ(swings, 2);
  }
}

/* E12.8, E12.10: a flexible body that floats is a system of one: at rest and spinning the same steady shape and the
   same complex modes as by E12.1 and E12.3, number and shapes included. */
TEST(a_free_body_is_a_system_of_one)
{
  for (int run = 0; run < 12;
       run++) { /* the joint is prescribed and then freed, or free at once, at rest or in flight */
    static fb_spectrum own;
    const int freed = run < 4;
    fb_state state;
    fb_motion motion;
    fb_input input;
    int common = 0;
    memset(&input, 0, sizeof input);
    input.w[2] = (fb_real)(1.5 * (run % 4));
    fresh();
    flexible_part(0, 2.0, 2, FB_BASE_FREE, FB_EFFECTS_FULL | FB_EFFECT_DAMPING);
    FBT_INT_EQ(fb_state_init(&part[0], &state), FB_OK);
    FBT_INT_EQ(fb_body_trim(&part[0], &state, &work, &input), FB_OK);
    FBT_INT_EQ(fb_body_spectrum(&own, &work, &part[0], &state, &input), FB_OK);
    FBT_INT_EQ(fb_body_motion(&part[0], &motion, &state, &input), FB_OK);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND)->mode[0] = freed ? FB_AXIS_PRESCRIBED : FB_AXIS_FREE;
    frame_turn(start[0].quat, 0.3, -0.5, 0.2);
    for (int i = 0; i < 3; i++) {
      start[0].speed[i] = run < 8 ? FB_R(0.0) : FB_R(0.7) * (fb_real)(i + 1);
      drive.drive[0].rate[i] = freed ? motion.v[i] : FB_R(0.0);
      drive.drive[0].rate[3 + i] = freed ? motion.w[i] : input.w[i];
    }
    build();
    FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), FB_OK);
    FBT_BELOW(fbt_difference(tree_state.link[0].q, state.q, 4), FBT_TOL(1e-12, 1e-5));
    FBT_INT_EQ(fb_system_axis_set(&mechanism, part, &tree_work.system, &tree_state, 0, 0, FB_AXIS_FREE, &drive), FB_OK);
    FBT_INT_EQ(fb_system_spectrum(&spectrum, &tree_work, &mechanism, part, &tree_state, &drive), FB_OK);
    for (int i = 0; i < own.n; i++) {
      const double re = (double)own.re[i], im = (double)own.im[i];
      double miss = 1.0;
      int at = 0;
      if (hypot(re, im) < 0.05) { /* what drifts is zero to a root of rounding */
        continue;
      }
      for (int k = 0; k < spectrum.n; k++) {
        const double d = hypot((double)spectrum.re[k] - re, (double)spectrum.im[k] - im) / hypot(re, im);
        at = d < miss ? k : at;
        miss = fmin(d, miss);
      }
      FBT_BELOW(miss, FBT_TOL(1e-9, 3e-3));
      common++;
      if (im > 5.0) { /* a mode of vibration: q_a of both in the same ratio */
        int most = 0;
        for (int a = 1; a < 4; a++) {
          most = hypot((double)own.shape_re[4 * i + a], (double)own.shape_im[4 * i + a]) >
                         hypot((double)own.shape_re[4 * i + most], (double)own.shape_im[4 * i + most])
                     ? a
                     : most;
        }
        for (int a = 0; a < 4; a++) { /* x_a y_most = y_a x_most */
          const int A = 4 * i + a, A0 = 4 * i + most, B = 10 * at + 6 + a, B0 = 10 * at + 6 + most;
          const number x = {(double)own.shape_re[A], (double)own.shape_im[A]};
          const number x0 = {(double)own.shape_re[A0], (double)own.shape_im[A0]};
          const number y = {(double)spectrum.shape_re[B], (double)spectrum.shape_im[B]};
          const number y0 = {(double)spectrum.shape_re[B0], (double)spectrum.shape_im[B0]};
          const number d = plus(times(x, y0), -1.0, times(y, x0));
          FBT_BELOW(hypot(d.re, d.im) / (hypot(x0.re, x0.im) * hypot(y0.re, y0.im)), FBT_TOL(1e-8, 1e-2));
        }
      }
      for (int a = 0; a < 6; a++) { /* the pose is left out */
        FBT_NEAR_ABS(spectrum.shape_re[10 * at + a], 0.0, 0.0);
      }
    }
    FBT_TRUE(common >= 4);
    if (run % 4 > 0) { /* at rest pairs of zeros may split either way */
      FBT_INT_EQ(spectrum.n, own.n);
    }
  }
}

/* E12.8, E12.9: a base that is driven around a circle bends and rings as a body on a prescribed base does, whatever the
   velocity of the frame that its momenta are against: from the trim, or a state that was set up as it is. */
TEST(a_driven_base_is_a_system_of_one)
{
  static fb_spectrum own;
  static const fb_real v[3] = {FB_R(3.0), FB_R(20.0), -FB_R(4.0)}, w[3] = {0, FB_R(0.4), FB_R(2.0)};
  for (int run = 0; run < 2; run++) {
    fb_state state;
    fb_input input;
    memset(&input, 0, sizeof input);
    memcpy(input.v, v, sizeof v);
    memcpy(input.w, w, sizeof w);
    fresh();
    flexible_part(0, 2.0, 2, FB_BASE_PRESCRIBED, FB_EFFECTS_FULL | FB_EFFECT_DAMPING);
    FBT_INT_EQ(fb_state_init(&part[0], &state), FB_OK);
    FBT_INT_EQ(fb_body_trim(&part[0], &state, &work, &input), FB_OK);
    FBT_INT_EQ(fb_body_spectrum(&own, &work, &part[0], &state, &input), FB_OK);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND)->mode[0] = FB_AXIS_PRESCRIBED;
    frame_turn(start[0].quat, 0.3, -0.5, 0.2);
    memcpy(start[0].q, state.q, sizeof start[0].q);
    memcpy(drive.drive[0].rate, v, sizeof v);
    memcpy(drive.drive[0].rate + 3, w, sizeof w);
    build();
    if (run == 0) {
      FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), FB_OK);
    }
    FBT_BELOW(fbt_difference(tree_state.link[0].q, state.q, 4), FBT_TOL(1e-10, 1e-5));
    FBT_INT_EQ(fb_system_spectrum(&spectrum, &tree_work, &mechanism, part, &tree_state, &drive), FB_OK);
    FBT_INT_EQ(spectrum.n, own.n);
    for (int i = 0; i < own.n && i < spectrum.n; i++) {
      FBT_NEAR_ABS(spectrum.re[i], own.re[i], FBT_TOL(1e-8, 3e-3) * fabs((double)own.im[i]));
      FBT_NEAR_REL(spectrum.im[i], own.im[i], FBT_TOL(1e-8, 3e-3));
    }
  }
}

/* E12.2, E12.9: a top that sleeps upright: in axes that do not spin its tilt goes as exp(i n t) with A n^2 - C s n + m
   g l = 0, in its own as exp(i (n - s) t); below the spin s at which n is real it falls. As a body on a pin and as a
   system with a ball joint, axes and attitude turned anyhow. */
TEST(sleeping_tops_tilt_in_closed_form)
{
  for (int run = 0; run < 10; run++) {
    const int single = run % 2;
    const double s = 4.0 + 3.0 * (run / 2), m = 2.0, l = 0.3, g = 9.81, A = 0.4, C = 0.15;
    const double square = C * C * s * s - 4.0 * A * m * g * l, mean = C * s / (2.0 * A) - s;
    const double size = sqrt(fabs(square)) / (2.0 * A);
    const fb_real center[3] = {0, 0, (fb_real)l};
    const fb_real J[6] = {(fb_real)(A - m * l * l), (fb_real)(A - m * l * l), (fb_real)C, 0, 0, 0};
    static fb_body_desc desc;
    double found[2] = {0, 0};
    memset(&desc, 0, sizeof desc);
    desc.base = single ? FB_BASE_PINNED : FB_BASE_PRESCRIBED;
    desc.effects = FB_EFFECT_GRAVITY;
    desc.gravity[2] = -(fb_real)g;
    FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)m, center, J), FB_OK);
    FBT_INT_EQ(fb_body_init(&part[0], &body_work, &shape, &desc), FB_OK);
    if (single) {
      const fb_real v[3] = {0}, w[3] = {0, 0, (fb_real)s};
      fb_input input;
      fb_state state;
      memset(&input, 0, sizeof input);
      FBT_INT_EQ(fb_state_init(&part[0], &state), FB_OK);
      frame_turn(state.quat, 0.0, 0.0, 0.9);
      FBT_INT_EQ(fb_state_from_velocity(&part[0], &state, v, w, NULL), FB_OK);
      FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &part[0], &state, &input), FB_OK);
    } else { /* R = attitude quat child_attitude^T = 1; speeds about the child's joint axes */
      fb_joint_desc *j;
      fb_real R[9];
      const fb_real w[3] = {0, 0, (fb_real)s};
      fresh();
      j = hang(0, 0, FB_JOINT_SPHERICAL, FB_GROUND);
      frame_turn(j->attitude, 0.4, -0.3, 0.8);
      frame_turn(j->child_attitude, -0.2, 0.9, 0.1);
      start[0].quat[0] = j->attitude[0];
      for (int i = 1; i < 4; i++) {
        start[0].quat[i] = -j->attitude[i];
      }
      {
        fb_real inverse[4];
        memcpy(inverse, start[0].quat, sizeof inverse);
        fb_quat_mul(start[0].quat, inverse, j->child_attitude);
      }
      fb_quat_to_mat33(R, j->child_attitude);
      fb_mat33_mulT_vec3(start[0].speed, R, w);
      build();
      FBT_INT_EQ(fb_system_spectrum(&spectrum, &tree_work, &mechanism, part, &tree_state, &drive), FB_OK);
    }
    for (int k = 0; k < spectrum.n; k++) {
      for (int side = 0; side < 2; side++) {
        const double sign = side ? -1.0 : 1.0;
        const double re = square < 0.0 ? sign * size : 0.0, im = fabs(mean + (square < 0.0 ? 0.0 : sign * size));
        found[side] += hypot((double)spectrum.re[k] - re, (double)spectrum.im[k] - im) < FBT_TOL(1e-8, 1e-2);
      }
    }
    FBT_NEAR_ABS(found[0], 1.0, 0.0);
    FBT_NEAR_ABS(found[1], 1.0, 0.0);
  }
}

/* ---- a disk (4 kg, with the radii of gyration 0.15 m and 0.112 m on 0.6 m) that spins at the tip of a clamped shaft */

static const double shaft_EI = 800.0; /* [N m^2] */

/* Model 0 the shaft with `natural` modes each way and the deflections under forces and moments at its tip, model 1 the
   disk on a bearing there. 0: not all of these could be told apart. */
static int shaft_with_disk(double length, double shaft, double disk, double spin, int natural)
{
  const double square = length * length / 0.36 * disk / 4.0;
  const fb_real none[3] = {0}, turn[3] = {0, (fb_real)(pi / 2), 0};
  const fb_real J[6] = {(fb_real)(0.09 * square), (fb_real)(0.05 * square), (fb_real)(0.05 * square), 0, 0, 0};
  fb_joint_desc *bearing;
  fresh();
  uniform_line(length, 6, shaft / length, shaft_EI, shaft_EI, natural);
  keep.n_load = 4;
  for (int i = 0; i < 4; i++) {
    keep.load[i].node = 6;
    keep.load[i].axis = i < 2 ? 1 + i : 2 + i;
  }
  level.base = FB_BASE_PRESCRIBED;
  level.effects = FB_EFFECTS_FULL;
  beam_body(&part[0], 0.0, NULL, NULL);
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)disk, none, J), FB_OK);
  FBT_INT_EQ(fb_body_init(&part[1], &body_work, &shape, &level), FB_OK);
  hang(0, 0, FB_JOINT_RIGID, FB_GROUND);
  bearing = hang(1, 1, FB_JOINT_REVOLUTE, 0);
  bearing->parent_node = 1;
  fb_quat_from_rotvec(bearing->attitude, turn); /* z of the joint along the shaft */
  fb_quat_from_rotvec(bearing->child_attitude, turn);
  start[1].speed[0] = (fb_real)spin;
  build();
  return part[0].n == 4 + 2 * natural;
}

/* What vanishes at a whirl of the massless shaft, y + i z = exp(i l t) at the tip. */
static double whirl_equation(double l, double length, double disk, double spin)
{
  const double square = length * length / 0.36 * disk / 4.0, stiff = shaft_EI / length;
  const double force = 12.0 * stiff / (length * length) - disk * l * l;
  const double moment = 4.0 * stiff - 0.05 * square * l * l + 0.09 * square * spin * l;
  return force * moment - 36.0 * stiff * stiff / (length * length);
}

/* Its four roots, by size: one on either side of +-sqrt(12 EI/(L^3 m)), where the equation is negative. */
static void whirls(double want[4], double length, double disk, double spin)
{
  const double middle = sqrt(12.0 * shaft_EI / (length * length * length * disk));
  for (int k = 0; k < 4; k++) {
    const double sign = k < 2 ? 1.0 : -1.0;
    double inside = sign * middle, outside = k % 2 ? sign * (1e3 * middle + 10.0 * spin) : 0.0;
    for (int i = 0; i < 200; i++) {
      const double at = 0.5 * (inside + outside);
      *(whirl_equation(at, length, disk, spin) < 0.0 ? &inside : &outside) = at;
    }
    want[k] = fabs(inside);
    for (int i = k; i > 0 && want[i] < want[i - 1]; i--) {
      const double other = want[i];
      want[i] = want[i - 1];
      want[i - 1] = other;
    }
  }
}

/* The mode of the spectrum whose frequency is nearest. */
static int nearest_mode(double want)
{
  int at = 0;
  for (int k = 1; k < spectrum.n; k++) {
    at = fabs((double)spectrum.im[k] - want) < fabs((double)spectrum.im[at] - want) ? k : at;
  }
  return at;
}

/* E12.9, E12.10, E12.12, E12.16: a disk that spins on a light shaft whirls forward and back at the roots of (k11 - m l^2)
   (k22 - Id l^2 + Ip s l) = k12^2, and nothing grows: shafts of 6 cm to 6 m and of a tenth to a ten thousandth of the disk's
   mass, spins from 0 to 600 rad/s. The shaft's own mass is worth at most its part of the disk's. The rest is within the
   errors that the spectrum tells, and these are small. */
TEST(shafts_with_disks_whirl_in_closed_form)
{
  double largest = 0.0;
  for (int run = 0; run < 72; run++) {
    const double length = 0.06 * pow(10.0, run % 3), disk = 4.0, shaft = 0.4 * pow(10.0, -(run / 3 % 4));
    const double spin = 120.0 * (run % 6);
    const int natural = run / 12 % FBT_TOL(6, 1);
    double want[4];
    FBT_TRUE(shaft_with_disk(length, shaft, disk, spin, natural));
    whirls(want, length, disk, spin);
    FBT_INT_EQ(fb_system_spectrum(&spectrum, &tree_work, &mechanism, part, &tree_state, &drive), FB_OK);
    FBT_BELOW((double)tree_work.common.linear.error, FBT_TOL(1e-10, 1e-3));
    FBT_TRUE(spectrum.n >= 6 + 2 * natural); /* the disk's angle is free: a pair of zeros may split either way */
    for (int k = 0; k < spectrum.n; k++) {
      FBT_BELOW(fabs((double)spectrum.re[k]), 20.0 * (double)spectrum.error[k]);
    }
    for (int i = 0; i < 4; i++) {
      const int k = nearest_mode(want[i]);
      const double error = (double)spectrum.error[k] / want[i], miss = fabs((double)spectrum.im[k] / want[i] - 1.0);
      FBT_BELOW(error, FBT_TOL(1e-5, 1e-2));
      FBT_BELOW(miss, shaft / disk + 4.0 * error);
      largest = shaft < 1e-3 ? fmax(largest, miss) : largest;
    }
  }
  fbt_figure("disk on a shaft of a ten thousandth of its mass, four whirls", "closed form", largest);
}

/* E12.3, E12.16: where shafts are so light, long and finely resolved that rounding takes the slow whirls away, the spectrum
   says so: each is within the error of a mode that is there, or the whole is refused. The lightest are beyond use. */
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
    status = fb_system_spectrum(&spectrum, &tree_work, &mechanism, part, &tree_state, &drive);
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

/* E12.2, E12.9: the pose of a free body against a frame that goes on with v, w: r' = -w x r - v x theta + .., theta' =
   -w x theta + .., whatever the attitude; as a body and as a system of one. */
TEST(poses_drift_as_the_frame_goes_on)
{
  static fb_linear linear;
  const fb_real w[3] = {FB_R(0.7), FB_R(1.1), -FB_R(0.4)};
  fb_real v[3] = {FB_R(0.5), -FB_R(0.3), FB_R(0.8)}, u[3], R[9];
  fb_state state;
  fb_input input;
  memset(&input, 0, sizeof input);
  fresh();
  flexible_part(0, 2.0, 1, FB_BASE_FREE, FB_EFFECTS_FULL);
  FBT_INT_EQ(fb_state_init(&part[0], &state), FB_OK);
  frame_turn(state.quat, 0.3, -0.8, 0.5);
  state.rho[0] = FB_R(2.0);
  FBT_INT_EQ(fb_state_from_velocity(&part[0], &state, v, w, NULL), FB_OK);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND);
  memcpy(start[0].quat, state.quat, sizeof state.quat);
  memcpy(start[0].value, state.rho, sizeof state.rho);
  memcpy(start[0].speed, v, sizeof v);
  memcpy(start[0].speed + 3, w, sizeof w);
  build();
  for (int system = 0; system < 2; system++) {
    const int at = system ? 0 : 10;
    if (system) {
      FBT_INT_EQ(fb_system_linearize(&mechanism, part, &linear, &tree_work, &tree_state, &drive, NULL), FB_OK);
      fb_quat_to_mat33(R, state.quat); /* momenta, and what turns with them, are relative to the frame of the state */
      fb_mat33_mulT_vec3(u, R, tree_state.link[0].u);
      for (int i = 0; i < 3; i++) {
        FBT_TRUE(fabs((double)u[i]) > 0.0);
        v[i] -= u[i];
      }
    } else {
      FBT_INT_EQ(fb_body_linearize(&part[0], &linear, &work, &state, &input, NULL), FB_OK);
    }
    FBT_INT_EQ(linear.n, 16);
    for (int j = 0; j < 3; j++) {
      fb_real unit[3] = {0, 0, 0}, turn[3], shift[3];
      unit[j] = FB_R(1.0);
      fb_vec3_cross(turn, unit, w);
      fb_vec3_cross(shift, unit, v);
      for (int i = 0; i < 3; i++) {
        FBT_NEAR_ABS(linear.A[(at + i) * 16 + at + j], turn[i], FBT_TOL(1e-11, 1e-4));
        FBT_NEAR_ABS(linear.A[(at + i) * 16 + at + 3 + j], shift[i], FBT_TOL(1e-11, 1e-4));
        FBT_NEAR_ABS(linear.A[(at + 3 + i) * 16 + at + 3 + j], turn[i], FBT_TOL(1e-11, 1e-4));
      }
    }
  }
}

/* A spacecraft that spins about z: hub, two flexible blades opposite each other on sprung hinges, an antenna on a
   sprung ball joint on the axis; base: of the hub. */
static void spinner(fb_axis_mode base, double Omega)
{
  fb_real up[4];
  fb_joint_desc *j;
  fresh();
  rigid_part(0, 8.0, 0.0, 3.0, 4.0, 6.0, 0.0);
  flexible_part(1, 2.0, 1, FB_BASE_PRESCRIBED, FB_EFFECTS_FULL | FB_EFFECT_DAMPING);
  rigid_part(2, 1.0, 0.4, 0.1, 0.35, 0.3, 0.0);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND)->mode[0] = base;
  for (int k = 1; k < 3; k++) { /* along x and -x: half a turn about z */
    j = hang(k, 1, FB_JOINT_REVOLUTE, 0);
    frame_turn(j->attitude, 0.0, 0.0, k == 1 ? 0.0 : pi);
    j->position[0] = k == 1 ? FB_R(0.5) : -FB_R(0.5);
    j->stiffness[0] = FB_R(30.0);
    j->damping[0] = FB_R(0.5);
  }
  j = hang(3, 2, FB_JOINT_SPHERICAL, 0); /* its x upwards */
  frame_turn(up, 0.0, -pi / 2, 0.0);
  frame_turn(j->child_attitude, 0.7, 0.0, 0.0);
  fb_quat_mul(j->attitude, up, j->child_attitude);
  j->position[2] = FB_R(0.3);
  j->stiffness[0] = FB_R(12.0);
  j->damping[0] = FB_R(0.2);
  drive.drive[0].rate[5] = (fb_real)Omega;
}

/* The drive with its input ports moved by u. */
static void ports_move(fb_system_input *input, const fb_linear_desc *ports, const double *u)
{
  *input = drive;
  for (int k = 0; k < ports->n_in; k++) {
    const fb_port *const port = &ports->in[k];
    fb_drive *const moved = &input->drive[port->body];
    if (port->kind == FB_PORT_DRIVE) {
      moved->torque[port->axis] += (fb_real)u[k];
    } else if (port->kind == FB_PORT_BASE_VELOCITY || port->kind == FB_PORT_BASE_RATE) {
      moved->rate[port->axis + (port->kind == FB_PORT_BASE_RATE ? 3 : 0)] += (fb_real)u[k];
    } else {
      fb_system_load *const load = &input->load[input->n_load++];
      load->body = port->body;
      load->load.node = port->node;
      load->load.axes = FB_AXES_BODY;
      (port->kind == FB_PORT_TORQUE ? load->load.torque : load->load.force)[port->axis] = (fb_real)u[k];
    }
  }
}

/* What an output port reads. */
static double port_reads(const fb_port *port, const fb_system_motion *motion)
{
  const int b = port->body;
  fb_node_motion at;
  fb_imu imu;
  FBT_INT_EQ(fb_body_node_motion(&part[tree.model[b]], &at, &motion->pose[b], &motion->motion[b], port->node), FB_OK);
  fb_imu_eval(&imu, &at, NULL);
  return (double)(port->kind == FB_PORT_COORDINATE     ? motion->joint[b].value
                  : port->kind == FB_PORT_SPEED        ? motion->joint[b].speed
                  : port->kind == FB_PORT_RATE         ? imu.angular_rate
                  : port->kind == FB_PORT_DISPLACEMENT ? at.displacement
                  : port->kind == FB_PORT_ACCELERATION ? imu.specific_force
                                                       : at.rotation)[port->axis];
}

/* How far the linear model, integrated, is off what the system answers to five inputs that move by size[k] in their own
   ways: the worst of eight outputs, by its largest change. From the trimmed state; n coordinates there are, n_free of
   joints. */
static double answers_apart(const fb_port in[5], const fb_port out[8], const double size[5], int n, int n_free)
{
  static fb_linear_desc ports;
  static fb_linear linear;
  static fb_system_motion motion;
  const double dt = 2e-3;
  double x[FB_MAX_LINEAR] = {0}, first[FB_MAX_PORTS] = {0}, worst[FB_MAX_PORTS] = {0}, most[FB_MAX_PORTS] = {0};
  double apart = 0.0;
  ports.n_in = 5;
  ports.n_out = 8;
  memcpy(ports.in, in, 5 * sizeof *in);
  memcpy(ports.out, out, 8 * sizeof *out);
  FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), FB_OK);
  FBT_INT_EQ(fb_system_linearize(&mechanism, part, &linear, &tree_work, &tree_state, &drive, &ports), FB_OK);
  FBT_INT_EQ(linear.n_free, n_free);
  FBT_INT_EQ(linear.n, 2 * n);
  for (int step = -1; step < 1500; step++) {
    const double way[5] = {cos(0.003 * step), step < 300 ? 1.0 : 0.0, -0.5, 0.2 * sin(0.01 * step),
                           0.5 * sin(0.004 * step)};
    double u[5] = {0};
    fb_system_input loads;
    for (int k = 0; k < ports.n_in && step >= 0; k++) {
      u[k] = size[k] * way[k];
    }
    ports_move(&loads, &ports, u);
    if (step >= 0) {
      FBT_INT_EQ(
          fb_system_rk4_step(&mechanism, part, &tree_state, &tree_work.system, &loads, &loads, &loads, (fb_real)dt),
          FB_OK);
      linear_step(x, &linear, u, dt);
    }
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, part, &tree_work.system, &motion, &tree_state, &loads), FB_OK);
    for (int k = 0; k < ports.n_out; k++) {
      const double y = port_reads(&out[k], &motion);
      first[k] = step < 0 ? y : first[k];
      worst[k] = fmax(worst[k], fabs(y - first[k] - (step < 0 ? 0.0 : linear_output(&linear, x, u, k))));
      most[k] = fmax(most[k], fabs(y - first[k]));
    }
  }
  for (int k = 0; k < ports.n_out; k++) {
    apart = fmax(apart, worst[k] / most[k]);
  }
  return apart;
}

/* E12.9: the linear model of a spinning spacecraft, integrated, answers to small torques, forces and turns of a given
   base as the system does: joint coordinates and speeds, gyros, deflections and an accelerometer. */
TEST(linear_models_answer_as_the_system_does)
{
  static const fb_port out[8] = {{FB_PORT_COORDINATE, 1, 0, 0},   {FB_PORT_SPEED, 2, 0, 0},
                                 {FB_PORT_COORDINATE, 3, 0, 1},   {FB_PORT_SPEED, 3, 0, 2},
                                 {FB_PORT_RATE, 3, 1, 1},         {FB_PORT_DISPLACEMENT, 2, 1, 2},
                                 {FB_PORT_ACCELERATION, 2, 1, 2}, {FB_PORT_ROTATION, 1, 1, 2}};
  const double small = FBT_TOL(1e-3, 3e-2);
  for (int base = 0; base < 2; base++) {
    const fb_port in[5] = {{base ? FB_PORT_BASE_RATE : FB_PORT_TORQUE, 0, 0, 0},
                           {FB_PORT_DRIVE, 1, 0, 0},
                           {FB_PORT_DRIVE, 3, 0, 1},
                           {FB_PORT_FORCE, 2, 1, 2},
                           {base ? FB_PORT_BASE_VELOCITY : FB_PORT_FORCE, 0, 0, 1}};
    const double size[5] = {base ? 0.02 * small : small, small, small, small, base ? 0.2 * small : small};
    const int n_free = base ? 5 : 11;
    spinner(base ? FB_AXIS_PRESCRIBED : FB_AXIS_FREE, 0.8);
    build();
    FBT_BELOW(answers_apart(in, out, size, 4 + n_free, n_free), FBT_TOL(5e-4, 1.5e-2));
  }
}

/* A free hub that spins about z, off its mass center, with a flexible blade on a sprung hinge, a body on a slide out along x
   and one on a sprung ball joint, in units of u meters and m kilograms: its linear model about the trimmed state, and in
   size those of x, of the inputs and of the outputs. */
static void system_in_units(fb_linear *linear, double size[3][FB_MAX_LINEAR], double u, double m)
{
  static const fb_linear_desc ports = {
      4,
      6,
      {{FB_PORT_FORCE, 1, 1, 1}, {FB_PORT_TORQUE, 0, 0, 2}, {FB_PORT_DRIVE, 1, 0, 0}, {FB_PORT_DRIVE, 2, 0, 0}},
      {{FB_PORT_COORDINATE, 2, 0, 0},
       {FB_PORT_SPEED, 2, 0, 0},
       {FB_PORT_SPEED, 3, 0, 1},
       {FB_PORT_DISPLACEMENT, 1, 1, 2},
       {FB_PORT_RATE, 3, 1, 0},
       {FB_PORT_ACCELERATION, 0, 1, 1}}};
  const double J = m * u * u, in[4] = {m * u, J, J, m * u}, out[6] = {u, u, 1.0, u, 1.0, u}, mode = u * sqrt(m);
  const double z[13] = {u, u, u, 1.0, 1.0, 1.0, 1.0, u, 1.0, 1.0, 1.0, mode, mode};
  const fb_real center[3] = {(fb_real)(0.1 * u), 0, 0},
                own[6] = {(fb_real)(0.8 * J), (fb_real)(0.5 * J), (fb_real)(0.9 * J)};
  fb_joint_desc *j;
  fresh();
  rigid_part(0, 8.0 * m, 0.1 * u, 3.0 * J, 4.0 * J, 6.0 * J, 0.0);
  uniform_line(2.0 * u, 6, 0.5 * m / u, 40.0 * J * u, 60.0 * J * u, 1);
  level.effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING;
  level.base = FB_BASE_PRESCRIBED;
  level.zeta[0] = FB_R(0.02);
  beam_body(&part[1], 2.0 * m, center, own);
  rigid_part(2, m, 0.4 * u, 0.1 * J, 0.35 * J, 0.3 * J, 0.0);
  (void)hang(0, 0, FB_JOINT_FREE, FB_GROUND);
  for (int k = 1; k < 4; k++) {
    j = hang(k, k == 1 ? 1 : 2, k == 1 ? FB_JOINT_REVOLUTE : k == 2 ? FB_JOINT_PRISMATIC : FB_JOINT_SPHERICAL, 0);
    j->position[k - 1] = (fb_real)(0.5 * u);
    j->stiffness[0] = (fb_real)(k == 2 ? 200.0 * m : 30.0 * J);
    j->damping[0] = (fb_real)(k == 2 ? 3.0 * m : 0.5 * J);
    frame_turn(j->attitude, 0.2 * k, k == 2 ? pi / 2 : -0.1 * k, 0.3);
  }
  drive.drive[0].rate[5] = FB_R(0.8);
  build();
  FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), FB_OK);
  FBT_INT_EQ(fb_system_linearize(&mechanism, part, linear, &tree_work, &tree_state, &drive, &ports), FB_OK);
  FBT_INT_EQ(linear->n, 26);
  for (int i = 0; i < 13; i++) {
    size[0][i] = z[i];
    size[0][13 + i] = J / z[i];
  }
  memcpy(size[1], in, sizeof in);
  memcpy(size[2], out, sizeof out);
}

/* E12.8, E12.9: the linear model of a system, too, is the same in every unit of length and of mass. */
TEST(linear_models_of_systems_do_not_depend_on_units)
{
  static fb_linear one, other;
  static double size[3][FB_MAX_LINEAR], same[3][FB_MAX_LINEAR];
  system_in_units(&one, same, 1.0, 1.0);
  for (int large = 0; large < 2; large++) {
    const double tol = FBT_TOL(1e-11, 1e-3);
    system_in_units(&other, size, large ? FBT_TOL(1e3, 1e2) : FBT_TOL(1e-3, 1e-2), large ? 0.125 : 8.0);
    FBT_BELOW(units_apart(other.A, one.A, size[0], size[0], 26, 26), tol);
    FBT_BELOW(units_apart(other.C, one.C, size[2], size[0], one.n_out, 26), tol);
    FBT_BELOW(units_apart(other.B, one.B, size[0], size[1], 26, one.n_in), tol);
    FBT_BELOW(units_apart(other.D, one.D, size[2], size[1], one.n_out, one.n_in), tol);
  }
}

/* E12.2, E12.9: a base that flies and spins fast: the acceleration w x v of its node has the derivatives w by v and v by w;
   of a body and of a system of one. */
TEST(fast_bases_have_linear_models)
{
  static const fb_linear_desc ports = {
      2, 1, {{FB_PORT_BASE_VELOCITY, 0, 0, 0}, {FB_PORT_BASE_RATE, 0, 0, 2}}, {{FB_PORT_ACCELERATION, 0, 0, 1}}};
  static fb_linear linear;
  for (int k = 0; k < 4; k++) {
    const fb_real v[3] = {k % 2 ? FB_R(1e6) : FB_R(1.0), 0, 0}, w[3] = {0, 0, k % 2 ? FB_R(0.5) : FB_R(1e6)};
    fresh();
    flexible_part(0, 2.0, 1, FB_BASE_PRESCRIBED, FB_EFFECTS_LINEAR);
    if (k < 2) {
      fb_state state;
      fb_input input;
      memset(&input, 0, sizeof input);
      memcpy(input.v, v, sizeof v);
      memcpy(input.w, w, sizeof w);
      FBT_INT_EQ(fb_state_init(&part[0], &state), FB_OK);
      FBT_INT_EQ(fb_body_linearize(&part[0], &linear, &work, &state, &input, &ports), FB_OK);
    } else {
      hang(0, 0, FB_JOINT_FREE, FB_GROUND)->mode[0] = FB_AXIS_PRESCRIBED;
      memcpy(drive.drive[0].rate, v, sizeof v);
      memcpy(drive.drive[0].rate + 3, w, sizeof w);
      build();
      FBT_INT_EQ(fb_system_linearize(&mechanism, part, &linear, &tree_work, &tree_state, &drive, &ports), FB_OK);
    }
    FBT_NEAR_REL(linear.D[0], w[2], FBT_TOL(1e-13, 1e-5));
    FBT_NEAR_REL(linear.D[1], v[0], FBT_TOL(1e-13, 1e-5));
  }
}

/* E12.9: a motor that pulls hard, on a hinge or a slide: a torque or force more is that much more of the momentum's rate. */
TEST(motors_that_pull_have_linear_models)
{
  static const fb_linear_desc ports = {1, 0, {{FB_PORT_DRIVE, 0, 0, 0}}, {{FB_PORT_FORCE, 0, 0, 0}}};
  static fb_linear linear;
  for (int k = 0; k < 2; k++) {
    fresh();
    rigid_part(0, 2.0, 0.1, 0.5, 0.5, 0.5, 0.0);
    hang(0, 0, k ? FB_JOINT_PRISMATIC : FB_JOINT_REVOLUTE, FB_GROUND);
    drive.drive[0].torque[0] = FB_R(-1e7);
    build();
    FBT_INT_EQ(fb_system_linearize(&mechanism, part, &linear, &tree_work, &tree_state, &drive, &ports), FB_OK);
    FBT_NEAR_ABS(linear.B[1], 1.0, FBT_TOL(1e-14, 1e-5));
  }
}

/* E12.9, E12.10: a pendulum and a top have their closed forms whatever the unit of time, and force, speed and rate of turn as
   inputs their derivatives: steps are those of what moves, not of a second. */
TEST(linear_models_follow_the_unit_of_time)
{
  static const fb_linear_desc motor = {1, 0, {{FB_PORT_DRIVE, 0, 0, 0}}, {{FB_PORT_FORCE, 0, 0, 0}}};
  static fb_linear linear;
  for (int run = 0; run < 5; run++) {
    const double rate = pow(10.0, FBT_TOL(10.0, 3.0) * (run - 2)), tol = FBT_TOL(1e-11, 1e-4);
    const double m = 2.0, c = 0.3, J = 0.5, w = rate * sqrt(m * 9.81 * c / J), s = 3.0 * rate;
    const fb_real center[3] = {0}, inertia[6] = {FB_R(1.0), FB_R(1.0), FB_R(1.5), 0, 0, 0};
    const fb_real still[3] = {0}, turn[3] = {0, 0, (fb_real)s};
    double nutation = HUGE_VAL;
    fb_body_desc free_body;
    fb_state state;
    fb_input input;
    fresh();
    rigid_part(0, m, c, 0.1, J, J, 9.81 * rate * rate); /* gravity along x */
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND);
    build();
    FBT_INT_EQ(fb_system_linearize(&mechanism, part, &linear, &tree_work, &tree_state, &drive, &motor), FB_OK);
    FBT_NEAR_REL(linear.B[1], 1.0, tol);
    FBT_NEAR_REL(linear.A[1], 1.0 / J, tol);
    FBT_NEAR_REL(linear.A[2], -m * 9.81 * c * rate * rate, tol);
    FBT_NEAR_ABS(linear.A[0], 0.0, tol * w);
    FBT_NEAR_ABS(linear.A[3], 0.0, tol * w);
    memset(&free_body, 0, sizeof free_body);
    FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)m, center, inertia), FB_OK);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &free_body), FB_OK);
    memset(&input, 0, sizeof input);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    frame_turn(state.quat, 0.4, -0.3, 0.8);
    FBT_INT_EQ(fb_state_from_velocity(&body, &state, still, turn, NULL), FB_OK);
    FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &body, &state, &input), FB_OK);
    for (int k = 0; k < spectrum.n; k++) { /* (C/A - 1) s */
      nutation = fmin(nutation, hypot((double)spectrum.re[k], (double)spectrum.im[k] - 0.5 * s) / s);
    }
    FBT_BELOW(nutation, tol);
  }
}

/* E12.9: a system with as many speeds, inputs and outputs as there is room for has a linear model: the torque of an axis is
   the rate of the momentum conjugate to it and of nothing else, what a coordinate reads is that coordinate. */
TEST(full_systems_have_linear_models)
{
  static const fb_joint_kind kinds[7] = {FB_JOINT_FREE,      FB_JOINT_REVOLUTE,  FB_JOINT_REVOLUTE, FB_JOINT_REVOLUTE,
                                         FB_JOINT_SPHERICAL, FB_JOINT_SPHERICAL, FB_JOINT_PRISMATIC};
  static fb_linear linear;
  static fb_linear_desc ports;
  int at = 6, place[FB_MAX_PORTS];
  fresh();
  flexible_part(0, 2.0, 6, FB_BASE_PRESCRIBED, FB_EFFECTS_FULL);
  rigid_part(1, 1.0, 0.4, 0.1, 0.35, 0.3, 0.0);
  ports.n_in = ports.n_out = FB_MAX_PORTS;
  for (int k = 0, port = 0; k < 7; k++) {
    const int n_axis = k == 0 ? 0 : kinds[k] == FB_JOINT_SPHERICAL ? 3 : 1;
    fb_joint_desc *const j = hang(k, k < 4 ? 0 : 1, kinds[k], k == 0 ? FB_GROUND : 0);
    j->position[1] = FB_R(0.3) * (fb_real)k;
    for (int i = 0; i < n_axis; i++, port++, at++) {
      const fb_port drive_port = {FB_PORT_DRIVE, k, 0, i}, read_port = {FB_PORT_COORDINATE, k, 0, i};
      ports.in[port] = drive_port;
      ports.out[port] = read_port;
      place[port] = at;
    }
  }
  for (int port = 10; port < FB_MAX_PORTS; port++) { /* the rest */
    const fb_port push = {FB_PORT_FORCE, 0, 1, port - 10}, read = {FB_PORT_RATE, 0, 1, port - 10};
    ports.in[port] = push;
    ports.out[port] = read;
  }
  FBT_INT_EQ(at + 4 * part[0].n, FB_MAX_SPEEDS);
  build();
  FBT_INT_EQ(fb_system_linearize(&mechanism, part, &linear, &tree_work, &tree_state, &drive, &ports), FB_OK);
  FBT_INT_EQ(linear.n, FB_MAX_LINEAR);
  for (int port = 0; port < 10; port++) {
    for (int i = 0; i < FB_MAX_LINEAR; i++) {
      FBT_NEAR_ABS(linear.B[i * FB_MAX_PORTS + port], i == FB_MAX_SPEEDS + place[port], FBT_TOL(1e-9, 1e-3));
      FBT_NEAR_ABS(linear.C[port * FB_MAX_LINEAR + i], i == place[port], FBT_TOL(1e-9, 1e-3));
    }
  }
}

/* E12.8: two free bodies on a sprung slide, pulled apart by F, rest with the spring F/k longer, however they are turned: what
   pushes each is much, what pushes both is nothing. One of the pulls alone is no rest. */
TEST(pulled_apart_free_bodies_rest)
{
  for (int run = 0; run < 6; run++) {
    const double k = 50.0, F = 4.0;
    fb_joint_desc *slide;
    fresh();
    rigid_part(0, 3.0, 0.0, 0.5, 0.6, 0.7, 0.0);
    rigid_part(1, 2.0, 0.0, 0.3, 0.4, 0.2, 0.0);
    (void)hang(0, 0, FB_JOINT_FREE, FB_GROUND);
    slide = hang(1, 1, FB_JOINT_PRISMATIC, 0);
    slide->stiffness[0] = (fb_real)k;
    frame_turn(start[0].quat, 0.3 * run, -0.5, 0.2 * run);
    drive.n_load = run < 5 ? 2 : 1;
    for (int i = 0; i < 2; i++) {
      drive.load[i].body = i;
      drive.load[i].load.axes = FB_AXES_BODY;
      drive.load[i].load.force[2] = (fb_real)(i ? F : -F);
    }
    build();
    FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), run < 5 ? FB_OK : FB_ERR_KIND);
    FBT_TRUE(run == 5 || fabs((double)tree_state.link[1].x[0] - F / k) < FBT_TOL(1e-12, 1e-6));
  }
}

/* Section 12: what cannot be linearized is refused, the state kept. */
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
  FBT_INT_EQ(fb_body_linearize(&body, NULL, &work, &state, &input, NULL), FB_ERR_NULL);
  FBT_INT_EQ(fb_body_linearize(&body, &linear, NULL, &state, &input, NULL), FB_ERR_NULL);
  input.n_load = 1;
  input.load[0].node = 99;
  linear.A[0] = FB_R(7.0);
  FBT_INT_EQ(fb_body_linearize(&body, &linear, &work, &state, &input, NULL), FB_ERR_CAPACITY);
  FBT_NEAR_ABS(linear.A[0], 7.0, 0.0);
  input.n_load = 0;
  memset(&ports, 0, sizeof ports);
  ports.n_in = FB_MAX_PORTS + 1;
  FBT_INT_EQ(fb_body_linearize(&body, &linear, &work, &state, &input, &ports), FB_ERR_CAPACITY);
  ports.n_in = 1;
  ports.in[0].axis = 3;
  FBT_INT_EQ(fb_body_linearize(&body, &linear, &work, &state, &input, &ports), FB_ERR_VALUE);
  ports.in[0].axis = 0;
  ports.in[0].node = 1;
  FBT_INT_EQ(fb_body_linearize(&body, &linear, &work, &state, &input, &ports), FB_ERR_CAPACITY);
  ports.in[0].kind = FB_PORT_RATE;
  FBT_INT_EQ(fb_body_linearize(&body, &linear, &work, &state, &input, &ports), FB_ERR_VALUE);
  ports.n_in = 0;
  ports.n_out = 1;
  ports.out[0].kind = FB_PORT_BASE_RATE;
  FBT_INT_EQ(fb_body_linearize(&body, &linear, &work, &state, &input, &ports), FB_ERR_VALUE);
  ports.out[0].kind = FB_PORT_COORDINATE; /* of joints */
  FBT_INT_EQ(fb_body_linearize(&body, &linear, &work, &state, &input, &ports), FB_ERR_VALUE);
  ports.out[0].kind = FB_PORT_RATE;
  ports.out[0].body = 1;
  FBT_INT_EQ(fb_body_linearize(&body, &linear, &work, &state, &input, &ports), FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_body_spectrum(NULL, &work, &body, &state, &input), FB_ERR_NULL);
  FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &body, NULL, &input), FB_ERR_NULL);
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
  FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &body, &state, &input), FB_ERR_NOT_FINITE);
}

static fb_status linearized(fb_linear *linear, const fb_linear_desc *ports)
{
  return fb_system_linearize(&mechanism, part, linear, &tree_work, &tree_state, &drive, ports);
}

/* A trapezoid of rods in a plane that turns about x at Omega (flat: in itself, about a point e above): two of length L
   hang from the hub at y = -D/2 and D/2, one of
   length b between their ends; angles from x (down). */
typedef struct linkage {
  double D, L, b, m_L, m_b, g, Omega, e;
  int flat;
  double phi[3];    /* of the rods, the middle one last */
  double end[4][2]; /* hinges, then the ends below them */
} linkage;

static void linkage_place(linkage *at, double phi)
{
  double mid[2], d[2], rise;
  at->end[0][0] = at->end[1][0] = 0.0;
  at->end[0][1] = -0.5 * at->D;
  at->end[1][1] = 0.5 * at->D;
  at->end[2][0] = at->L * cos(phi);
  at->end[2][1] = -0.5 * at->D + at->L * sin(phi);
  { /* the circles of b about the one end and of L about the other hinge, the lower intersection */
    const double x = at->end[2][0], y = at->end[2][1] - 0.5 * at->D, s = x * x + y * y;
    const double along = 0.5 * (s + at->L * at->L - at->b * at->b) / s;
    rise = sqrt(at->L * at->L / s - along * along);
    mid[0] = along * x;
    mid[1] = along * y;
    d[0] = -rise * y;
    d[1] = rise * x;
  }
  at->end[3][0] = mid[0] + d[0];
  at->end[3][1] = mid[1] + d[1] + 0.5 * at->D;
  at->phi[0] = phi;
  at->phi[1] = atan2(at->end[3][1] - 0.5 * at->D, at->end[3][0]);
  at->phi[2] = atan2(at->end[3][1] - at->end[2][1], at->end[3][0] - at->end[2][0]);
}

/* int (z_0 + (z_1 - z_0) s)^2 dm of the rods, z a coordinate of their ends */
static double linkage_square(const linkage *at, const double z[4])
{
  return at->m_L / 3.0 * (z[0] * z[0] + z[0] * z[2] + z[2] * z[2] + z[1] * z[1] + z[1] * z[3] + z[3] * z[3]) +
         at->m_b / 3.0 * (z[2] * z[2] + z[2] * z[3] + z[3] * z[3]);
}

static double linkage_potential(linkage *at, double phi)
{
  double x[4], y[4];
  linkage_place(at, phi);
  for (int i = 0; i < 4; i++) {
    x[i] = at->end[i][0] + at->e;
    y[i] = at->end[i][1];
  }
  return -0.5 * at->g * (at->m_L + at->m_b) * (at->end[2][0] + at->end[3][0]) -
         0.5 * at->Omega * at->Omega * (linkage_square(at, y) + (at->flat ? linkage_square(at, x) : 0.0));
}

/* Inertia for phi', from the ends' motion. */
static double linkage_inertia(linkage *at, double phi)
{
  static const double weight[4] = {1.0 / 12.0, -2.0 / 3.0, 2.0 / 3.0, -1.0 / 12.0}, step[4] = {-2, -1, 1, 2};
  const double h = 3e-3;
  double v[2][4] = {{0}};
  for (int k = 0; k < 4; k++) {
    linkage_place(at, phi + step[k] * h);
    for (int i = 0; i < 8; i++) {
      v[i % 2][i / 2] += weight[k] / h * at->end[i / 2][i % 2];
    }
  }
  return linkage_square(at, v[0]) + linkage_square(at, v[1]);
}

/* E12.11, with E12.8 to E12.10: rods that close a loop, in a plane that spins: where they hang, by Newton's method from
   aside, and how they swing there, omega^2 = V''/M of the one angle there is; V, M from the rods' ends. The loop's
   rows say three things twice, its forces are not zero, and its potential is bent: D != b. With D = b it is a
   parallelogram with omega^2 = g (m_L + m_b) L/(2 m_L L^2/3 + m_b L^2) at rest. */
TEST(rods_in_a_loop_swing_as_one_pendulum)
{
  double largest = 0.0;
  for (int run = 0; run < 8; run++) {
    const int flat = run > 5; /* the joints' momenta are not zero */
    linkage at = {0.9,
                  0.7,
                  0.5 + 0.2 * (run % 6),
                  1.1,
                  0.8,
                  flat ? 0.0 : 9.81,
                  flat ? 5.0 : run % 2 ? 1.5 : 0.0,
                  flat ? 0.4 : 0.0,
                  flat,
                  {0},
                  {{0}}};
    const double h = 3e-3, guess = run < 2 ? 0.6 : 0.2;
    static fb_linear linear;
    double phi = guess, V[5], M, omega, ratio;
    fb_joint_desc *j;
    for (int step = 0; step < 30; step++) {
      for (int k = 0; k < 5; k++) {
        V[k] = linkage_potential(&at, phi + (k - 2) * h);
      }
      phi -= (V[0] - 8.0 * V[1] + 8.0 * V[3] - V[4]) / (12.0 * h) /
             ((-V[0] + 16.0 * V[1] - 30.0 * V[2] + 16.0 * V[3] - V[4]) / (12.0 * h * h));
    }
    M = linkage_inertia(&at, phi);
    omega = sqrt((-V[0] + 16.0 * V[1] - 30.0 * V[2] + 16.0 * V[3] - V[4]) / (12.0 * h * h) / M);
    if (run == 2) {
      FBT_NEAR_REL(omega,
                   sqrt(at.g * (at.m_L + at.m_b) * at.L / (2.0 * at.m_L * at.L * at.L / 3.0 + at.m_b * at.L * at.L)),
                   1e-8);
    }
    rotor(at.Omega);
    frame_turn(tree.joint[0].attitude, 0.0, flat ? 0.0 : pi / 2, 0.0);
    frame_turn(tree.joint[0].child_attitude, 0.0, flat ? 0.0 : pi / 2, 0.0);
    rigid_part(1, at.m_L, 0.5 * at.L, 0.0, at.m_L * at.L * at.L / 3.0, at.m_L * at.L * at.L / 3.0, at.g);
    rigid_part(2, at.m_b, 0.5 * at.b, 0.0, at.m_b * at.b * at.b / 3.0, at.m_b * at.b * at.b / 3.0, at.g);
    hang(1, 1, FB_JOINT_REVOLUTE, 0)->position[1] = -(fb_real)(0.5 * at.D);
    hang(2, 2, FB_JOINT_REVOLUTE, 1)->parent_node = 1;
    hang(3, 1, FB_JOINT_REVOLUTE, 0)->position[1] = (fb_real)(0.5 * at.D);
    tree.joint[1].position[0] = tree.joint[3].position[0] = (fb_real)at.e;
    tree.n_loop = 1;
    tree.method = run == 3 ? FB_METHOD_DENSE : FB_METHOD_RECURSIVE;
    j = &tree.loop[0];
    j->kind = FB_JOINT_REVOLUTE;
    j->parent = 2;
    j->parent_node = 1;
    j->child = 3;
    j->child_node = 1;
    linkage_place(&at, guess);
    start[1].value[0] = (fb_real)at.phi[0];
    start[2].value[0] = (fb_real)(at.phi[2] - at.phi[0]);
    start[3].value[0] = (fb_real)at.phi[1];
    build();
    trim_and_modes();
    linkage_place(&at, phi);
    FBT_NEAR_ABS(tree_state.link[1].x[0], phi, FBT_TOL(1e-9, 1e-4));
    FBT_NEAR_ABS(tree_state.link[3].x[0], at.phi[1], FBT_TOL(1e-9, 1e-4));
    FBT_INT_EQ(spectrum.n, 1);
    FBT_NEAR_REL(spectrum.im[0], omega, FBT_TOL(1e-8, 2e-3));
    FBT_NEAR_ABS(spectrum.re[0], 0.0, FBT_TOL(1e-9, 1e-2));
    largest = fmax(largest, fabs((double)spectrum.im[0] / omega - 1.0));
    linkage_place(&at, phi + h);
    ratio = at.phi[1];
    linkage_place(&at, phi - h);
    ratio = (ratio - at.phi[1]) / (2.0 * h); /* the shape has all joints: (phi, phi_b - phi, phi_2) */
    {
      const number first = {(double)spectrum.shape_re[0], (double)spectrum.shape_im[0]};
      const number third = {(double)spectrum.shape_re[2], (double)spectrum.shape_im[2]};
      const number miss = plus(third, -ratio, first);
      FBT_BELOW(hypot(miss.re, miss.im) / hypot(first.re, first.im), FBT_TOL(1e-4, 1e-3));
    }
    FBT_INT_EQ(linearized(&linear, NULL), FB_OK);
    FBT_INT_EQ(linear.n, 2);
    FBT_INT_EQ(linear.n_free, 1);
  }
  tree.joint[1].mode[0] = FB_AXIS_PRESCRIBED;
  drive.drive[1].value[0] = start[1].value[0];
  build();
  {
    const fb_system_state before = tree_state;
    fb_status status;
    drive.drive[1].value[0] = -FB_R(1.5); /* the others do not reach it there */
    status = fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive);
    FBT_TRUE(status == FB_ERR_CONTRADICTION || status == FB_ERR_SINGULAR);
    FBT_INT_EQ(tree_work.system.joint, mechanism.n_body);
    FBT_TRUE(memcmp(&before, &tree_state, sizeof before) == 0);
  }
  fbt_figure("rods in a loop that spins, frequency", "potential of one angle", largest);
}

/* E12.9, E12.11: the linear model of a loop that spins, integrated, answers as the system does: dependent coordinates,
   which have momenta, are among inputs and outputs, and the base moves freely or as it is told. */
TEST(linear_models_answer_as_the_loop_does)
{
  static const fb_port out[8] = {{FB_PORT_COORDINATE, 1, 0, 0},   {FB_PORT_SPEED, 3, 0, 0},
                                 {FB_PORT_COORDINATE, 2, 0, 0},   {FB_PORT_RATE, 2, 1, 2},
                                 {FB_PORT_ACCELERATION, 2, 1, 0}, {FB_PORT_ACCELERATION, 3, 1, 1},
                                 {FB_PORT_DISPLACEMENT, 1, 1, 1}, {FB_PORT_ROTATION, 3, 1, 2}};
  const double small = FBT_TOL(1e-3, 3e-2);
  for (int base = 0; base < 2; base++) {
    const fb_port in[5] = {{base ? FB_PORT_BASE_RATE : FB_PORT_TORQUE, 0, 0, 2},
                           {FB_PORT_DRIVE, 3, 0, 0},
                           {FB_PORT_FORCE, 2, 1, 0},
                           {FB_PORT_DRIVE, 2, 0, 0},
                           {base ? FB_PORT_BASE_VELOCITY : FB_PORT_FORCE, 0, 0, 1}};
    const double size[5] = {base ? 0.05 * small : small, small, small, small, small};
    const int n_free = base ? 1 : 7;
    boom_loop(base ? FB_AXIS_PRESCRIBED : FB_AXIS_FREE);
    build();
    FBT_BELOW(answers_apart(in, out, size, 3 + n_free, n_free), FBT_TOL(5e-4, 1.5e-2));
  }
}

/* E12.11: a cantilever whose tip a ball joint holds in place has no joint that could follow, only modes: the
   frequencies are the roots of sum psi_a(tip)^2/(omega_a^2 - omega^2) = 0 in either plane, one less than modes each. */
TEST(held_tips_take_a_mode_away)
{
  fb_joint_desc *const hold = &tree.loop[0];
  fresh();
  flexible_part(0, 2.0, 3, FB_BASE_PRESCRIBED, FB_EFFECTS_LINEAR);
  hang(0, 0, FB_JOINT_RIGID, FB_GROUND);
  tree.n_loop = 1;
  hold->kind = FB_JOINT_SPHERICAL;
  hold->parent = FB_GROUND;
  hold->position[0] = FB_R(2.0);
  hold->child_node = 1;
  build();
  trim_and_modes();
  FBT_INT_EQ(spectrum.n, 4);
  for (int k = 0; k < spectrum.n; k++) {
    const double square = (double)spectrum.im[k] * (double)spectrum.im[k];
    double sum[3] = {0}, size[3] = {0};
    for (int a = 0; a < 6; a++) {
      for (int axis = 1; axis < 3; axis++) {
        const double psi = (double)part[0].node[1].psi[3 * a + axis];
        const double term = psi * psi / ((double)shape.K[7 * a] - square);
        sum[axis] += term;
        size[axis] += fabs(term);
      }
    }
    FBT_BELOW(fmin(fabs(sum[1] / size[1]), fabs(sum[2] / size[2])), FBT_TOL(1e-9, 1e-3));
    FBT_NEAR_ABS(spectrum.re[k], 0.0, FBT_TOL(1e-9, 1e-2));
    for (int axis = 1; axis < 3; axis++) { /* the shape does not move the tip */
      double tip = 0.0, most = 0.0;
      for (int a = 0; a < 6; a++) {
        const double q = (double)spectrum.shape_re[6 * k + a] + (double)spectrum.shape_im[6 * k + a];
        tip += (double)part[0].node[1].psi[3 * a + axis] * q;
        most += fabs((double)part[0].node[1].psi[3 * a + axis] * q);
      }
      FBT_NEAR_ABS(tip, 0.0, FBT_TOL(1e-10, 1e-4) * (most + 1.0));
    }
  }
}

static int no_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  (void)row, (void)capacity, (void)pose, (void)t, (void)user;
  return 0;
}

/* Section 12: the same of systems: what is missing, ports that are not there, what has no linear model of this kind,
   what cannot rest; nothing given is changed. */
TEST(analysis_of_systems_refuses_bad_input)
{
  static const struct {
    fb_port port;
    int input;
    fb_status status;
  } wrong[] = {{{FB_PORT_DRIVE, 0, 0, 0}, 1, FB_ERR_VALUE},         /* a free joint has no motor */
               {{FB_PORT_DRIVE, 4, 0, 0}, 1, FB_ERR_CAPACITY},      /* no such body */
               {{FB_PORT_DRIVE, -1, 0, 0}, 1, FB_ERR_CAPACITY},     /* the ground */
               {{FB_PORT_DRIVE, 1, 0, 1}, 1, FB_ERR_CAPACITY},      /* no such axis */
               {{FB_PORT_DRIVE, 1, 0, 0}, 0, FB_ERR_VALUE},         /* no output */
               {{FB_PORT_SPEED, 1, 0, 0}, 1, FB_ERR_VALUE},         /* no input */
               {{FB_PORT_SPEED, 1, 0, 3}, 0, FB_ERR_VALUE},         /* no axis at all */
               {{FB_PORT_COORDINATE, 1, 0, 1}, 0, FB_ERR_CAPACITY}, /* no such axis */
               {{FB_PORT_BASE_RATE, 1, 0, 0}, 1, FB_ERR_VALUE},     /* not prescribed */
               {{FB_PORT_FORCE, 0, 7, 0}, 1, FB_ERR_CAPACITY},      /* no such node */
               {{FB_PORT_RATE, 3, 9, 0}, 0, FB_ERR_CAPACITY},       /* no such node */
               {{(fb_port_kind)11, 1, 0, 0}, 0, FB_ERR_VALUE}};     /* no such kind */
  static fb_linear linear, linear_before;
  static fb_spectrum before_spectrum;
  static fb_system_state before;
  static fb_linear_desc ports;
  spinner(FB_AXIS_PRESCRIBED, 0.8);
  tree.joint[2].mode[0] = FB_AXIS_LOCKED;
  build();
  memset(&linear, 0x5a, sizeof linear);
  linear_before = linear;
  before_spectrum = spectrum;
  before = tree_state;
  FBT_INT_EQ(fb_system_trim(NULL, part, &tree_state, &tree_work, &drive), FB_ERR_NULL);
  FBT_INT_EQ(fb_system_trim(&mechanism, NULL, &tree_state, &tree_work, &drive), FB_ERR_NULL);
  FBT_INT_EQ(fb_system_trim(&mechanism, part, NULL, &tree_work, &drive), FB_ERR_NULL);
  FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, NULL, &drive), FB_ERR_NULL);
  FBT_INT_EQ(fb_system_linearize(&mechanism, part, NULL, &tree_work, &tree_state, &drive, NULL), FB_ERR_NULL);
  FBT_INT_EQ(fb_system_linearize(&mechanism, part, &linear, NULL, &tree_state, &drive, NULL), FB_ERR_NULL);
  FBT_INT_EQ(fb_system_linearize(&mechanism, part, &linear, &tree_work, NULL, &drive, NULL), FB_ERR_NULL);
  FBT_INT_EQ(fb_system_spectrum(NULL, &tree_work, &mechanism, part, &tree_state, &drive), FB_ERR_NULL);
  FBT_INT_EQ(fb_system_spectrum(&spectrum, NULL, &mechanism, part, &tree_state, &drive), FB_ERR_NULL);
  FBT_INT_EQ(fb_system_spectrum(&spectrum, &tree_work, NULL, part, &tree_state, &drive), FB_ERR_NULL);
  for (int k = 0; k < FBT_COUNT(wrong); k++) {
    memset(&ports, 0, sizeof ports);
    ports.n_in = wrong[k].input;
    ports.n_out = !wrong[k].input;
    ports.in[0] = ports.out[0] = wrong[k].port;
    FBT_INT_EQ(linearized(&linear, &ports), wrong[k].status);
  }
  ports.n_in = 1;
  ports.n_out = 0;
  ports.in[0].kind = FB_PORT_DRIVE;
  ports.in[0].body = 2; /* its axis is locked */
  FBT_INT_EQ(linearized(&linear, &ports), FB_ERR_VALUE);
  ports.in[0].kind = FB_PORT_FORCE;
  drive.n_load = FB_MAX_LOADS; /* no room for one more */
  FBT_INT_EQ(linearized(&linear, &ports), FB_ERR_CAPACITY);
  drive.n_load = 0;
  ports.n_out = FB_MAX_PORTS + 1;
  FBT_INT_EQ(linearized(&linear, &ports), FB_ERR_CAPACITY);
  drive.drive[1].torque[0] = (fb_real)NAN;
  FBT_INT_EQ(linearized(&linear, NULL), FB_ERR_NOT_FINITE);
  FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), FB_ERR_NOT_FINITE);
  drive.drive[1].torque[0] = FB_R(0.0);
  drive.drive[0].rate[5] = FB_R(300.0); /* the blades bend beyond what they may */
  drive.n_load = 1;
  drive.load[0].body = drive.load[0].load.node = 1;
  drive.load[0].load.axes = FB_AXES_BODY;
  drive.load[0].load.force[2] = FB_R(1e5);
  FBT_TRUE(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive) != FB_OK);
  drive.n_load = 0;
  FBT_TRUE(memcmp(&before, &tree_state, sizeof before) == 0);
  tree_state.link[1].q[0] = (fb_real)NAN;
  FBT_INT_EQ(linearized(&linear, NULL), FB_ERR_NOT_FINITE);
  FBT_INT_EQ(fb_system_spectrum(&spectrum, &tree_work, &mechanism, part, &tree_state, &drive), FB_ERR_NOT_FINITE);
  spinner(FB_AXIS_LOCKED, 0.0);
  memset(&ports, 0, sizeof ports);
  ports.n_in = 1;
  ports.in[0].kind = FB_PORT_BASE_RATE; /* of a free joint, but locked */
  build();
  FBT_INT_EQ(linearized(&linear, &ports), FB_ERR_VALUE);
  tree.joint[1].stiffness[0] = FB_R(0.0); /* the blade swings freely in its plane */
  build();
  before = tree_state;
  FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), FB_ERR_SINGULAR);
  FBT_TRUE(memcmp(&before, &tree_state, sizeof before) == 0);
  tree.joint[1].stiffness[0] = FB_R(30.0);
  tree.method = FB_METHOD_MULTIPLIERS;
  build();
  tree_work.system.joint = 2; /* from another failure */
  FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), FB_ERR_KIND);
  FBT_INT_EQ(tree_work.system.joint, -1);
  FBT_INT_EQ(linearized(&linear, NULL), FB_ERR_KIND);
  FBT_INT_EQ(fb_system_spectrum(&spectrum, &tree_work, &mechanism, part, &tree_state, &drive), FB_ERR_KIND);
  tree.method = FB_METHOD_RECURSIVE;
  build();
  drive.rows = no_rows;
  FBT_INT_EQ(linearized(&linear, NULL), FB_ERR_KIND);
  fresh();
  flexible_part(0, 2.0, 5, FB_BASE_PRESCRIBED, FB_EFFECTS_LINEAR);
  for (int k = 0; k < FB_MAX_BODIES; k++) {
    hang(k, 0, FB_JOINT_REVOLUTE, FB_GROUND);
  }
  build();
  FBT_TRUE(FB_MAX_BODIES * 11 > FB_MAX_LINEAR / 2);
  FBT_INT_EQ(linearized(&linear, NULL), FB_ERR_CAPACITY);
  FBT_TRUE(memcmp(&linear, &linear_before, sizeof linear) == 0);
  FBT_TRUE(memcmp(&spectrum, &before_spectrum, sizeof spectrum) == 0);
}

SUITE(analyse, RUN(pulled_apart_free_bodies_rest), RUN(advised_steps_follow_the_unit_of_time),
      RUN(linear_models_of_systems_do_not_depend_on_units), RUN(fast_bases_have_linear_models),
      RUN(motors_that_pull_have_linear_models), RUN(full_systems_have_linear_models),
      RUN(margins_name_the_worst_mode_wherever_it_stands), RUN(linear_models_do_not_depend_on_units),
      RUN(spectrum_of_a_spinning_oscillator_is_closed_form), RUN(bases_that_move_move_the_state_of_rest),
      RUN(damped_modes_have_their_ratios), RUN(free_tops_nutate_as_euler_says),
      RUN(equal_inertias_spin_about_any_of_their_axes), RUN(a_weight_across_the_axis_is_no_rest),
      RUN(a_hinge_turns_what_spins_about_no_axis_of_its_own), RUN(damped_spinning_satellite_has_its_closed_form),
      RUN(linear_models_answer_as_the_body_does), RUN(step_limits_are_those_of_the_spectrum),
      RUN(step_limits_hold_for_modes_that_grow), RUN(advised_steps_err_as_wanted),
      RUN(advised_steps_are_those_whose_errors_add_up), RUN(advised_steps_bear_stiff_damping),
      RUN(advice_resolves_modes_that_die_out), RUN(nrel_blade_has_the_published_figures),
      RUN(hinged_blades_flap_and_lag_in_closed_form), RUN(blades_cone_under_a_moment),
      RUN(bases_that_are_pushed_have_no_state_of_rest), RUN(double_pendulum_swings_in_closed_form),
      RUN(a_free_body_is_a_system_of_one), RUN(a_driven_base_is_a_system_of_one), RUN(opposite_pulls_hold_a_free_body),
      RUN(sleeping_tops_tilt_in_closed_form), RUN(shafts_with_disks_whirl_in_closed_form),
      RUN(linear_models_follow_the_unit_of_time), RUN(errors_of_spectra_are_told),
      RUN(poses_drift_as_the_frame_goes_on), RUN(linear_models_answer_as_the_system_does),
      RUN(analysis_refuses_bad_input), RUN(rods_in_a_loop_swing_as_one_pendulum),
      RUN(linear_models_answer_as_the_loop_does), RUN(held_tips_take_a_mode_away),
      RUN(analysis_of_systems_refuses_bad_input))
