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
      FBT_NEAR_ABS(p * u - q * v + 4.0 * w * w * s, 0.0, FBT_TOL(2e-9, 0.2));
      FBT_NEAR_ABS(p * v + q * u + 4.0 * w * w * t, 0.0, FBT_TOL(2e-9, 0.2));
      sum += x * (y > 0.0 ? 2.0 : 1.0);
      unstable = fmax(unstable, x);
      FBT_NEAR_ABS(fb_spectrum_damping(&spectrum, k), -x / sqrt(x * x + y * y), 8.0 * EPS);
    }
    FBT_NEAR_ABS(sum, -cx - cy, FBT_TOL(1e-11, 1e-3)); /* all four are there: the trace */
    FBT_TRUE((unstable > 0.1) == (w > 2.0 && w < 3.0));
  }
}

/* E12.3, E8.7: at rest the complex modes are the modes, with their damping ratios, frequencies and shapes. */
TEST(damped_modes_have_their_ratios)
{
  static fb_beam_desc desc;
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_modes_desc keep;
  static fb_body_desc level;
  fb_state state;
  fb_input input;
  desc.length = FB_R(2.0);
  desc.n_element = 4;
  desc.n_station = 1;
  desc.station[0].mass = FB_R(3.0);
  desc.station[0].EI_y = FB_R(50.0);
  desc.station[0].EI_z = FB_R(70.0);
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 3;
  level.effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING | FB_EFFECT_GRAVITY;
  level.base = FB_BASE_PRESCRIBED;
  level.gravity[1] = -FB_R(0.1);
  for (int k = 0; k < 6; k++) {
    level.zeta[k] = FB_R(0.01) * (fb_real)(k + 1);
  }
  memset(&input, 0, sizeof input);
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
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

/* E12.2: the linear model, integrated, answers to small forces and torques as the body does, about a free spin: rates,
   deflections and accelerations of hub and tip. */
TEST(linear_models_answer_as_the_body_does)
{
  static fb_beam_desc desc;
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_modes_desc keep;
  static fb_body_desc level;
  static fb_linear linear;
  const fb_real center[3] = {0}, J[6] = {FB_R(30.0), FB_R(40.0), FB_R(60.0), 0, 0, 0};
  const double size = FBT_TOL(1e-3, 1e-1), dt = 1e-3; /* of the loads */
  fb_linear_desc ports;
  fb_state state, steady;
  fb_input input, loads;
  fb_rk4_work rk4;
  double x[FB_MAX_LINEAR] = {0}, base[8] = {0}, worst[8] = {0}, most[8] = {0};
  int node = 0;
  memset(&desc, 0, sizeof desc);
  memset(&keep, 0, sizeof keep);
  memset(&level, 0, sizeof level);
  desc.length = FB_R(5.0);
  desc.n_element = 6;
  desc.n_station = 1;
  desc.station[0].mass = FB_R(1.0);
  desc.station[0].EI_y = FB_R(300.0);
  desc.station[0].EI_z = FB_R(500.0);
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 2;
  level.effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING;
  for (int a = 0; a < 4; a++) {
    level.zeta[a] = FB_R(0.02);
  }
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(100.0), center, J), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, FB_R(5.0)), FB_OK);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
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
    double k1[FB_MAX_LINEAR], half[FB_MAX_LINEAR], f[FB_MAX_LINEAR];
    fb_motion motion;
    memset(&loads, 0, sizeof loads);
    if (step >= 0) {
      loads.n_load = 2;
      loads.load[0].axes = loads.load[1].axes = FB_AXES_BODY;
      loads.load[0].torque[1] = (fb_real)u[0];
      loads.load[1].force[1] = (fb_real)u[1];
      loads.load[1].node = node;
      FBT_INT_EQ(fb_rk4_step(&body, &state, &rk4, &loads, &loads, &loads, (fb_real)dt), FB_OK);
      for (int stage = 0; stage < 4; stage++) { /* rk4 of the linear model */
        const double at[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
        for (int i = 0; i < linear.n; i++) {
          half[i] = x[i] + (stage ? at[stage] * dt * k1[i] : 0.0);
          f[i] = stage ? f[i] : 0.0;
        }
        for (int i = 0; i < linear.n; i++) {
          k1[i] = (double)linear.B[2 * i] * u[0] + (double)linear.B[2 * i + 1] * u[1];
          for (int j = 0; j < linear.n; j++) {
            k1[i] += (double)linear.A[i * linear.n + j] * half[j];
          }
          f[i] += weight[stage] * k1[i];
        }
      }
      for (int i = 0; i < linear.n; i++) {
        x[i] += dt * f[i];
      }
    }
    FBT_INT_EQ(fb_body_motion(&body, &motion, &state, &loads), FB_OK);
    for (int k = 0; k < 8; k++) {
      fb_node_motion at;
      fb_imu imu;
      double y, want = step < 0 ? 0.0 : (double)linear.D[2 * k] * u[0] + (double)linear.D[2 * k + 1] * u[1];
      FBT_INT_EQ(fb_body_node_motion(&body, &at, &state, &motion, ports.out[k].node), FB_OK);
      fb_imu_eval(&imu, &at, NULL);
      y = (double)(k < 3   ? imu.angular_rate
                   : k < 5 ? at.displacement
                   : k < 7 ? imu.specific_force
                           : at.rotation)[ports.out[k].axis];
      base[k] = step < 0 ? y : base[k];
      for (int j = 0; j < linear.n; j++) {
        want += (double)linear.C[k * linear.n + j] * x[j];
      }
      worst[k] = fmax(worst[k], fabs(y - base[k] - want));
      most[k] = fmax(most[k], fabs(y - base[k]));
    }
  }
  for (int k = 0; k < 8; k++) {
    FBT_BELOW(worst[k] / most[k], FBT_TOL(1e-4, 3e-2));
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
  static fb_beam_desc desc;
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_modes_desc keep;
  static fb_body_desc level;
  const fbt_table *table = fbt_reference("nrel5mw_blade.csv");
  double sum[3] = {0.0, 0.0, 0.0}, largest = 0.0;
  FBT_INT_EQ(table->rows, 49);
  desc.length = (fb_real)length;
  desc.n_element = 10;
  desc.n_station = table->rows;
  desc.position[0] = FB_R(1.5);
  for (int k = 0; k < table->rows; k++) {
    fb_section *s = &desc.station[k];
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
    beam.desc = desc;
    fb_beam_section(&s, &beam, (fb_real)x);
    for (int power = 0; power < 3; power++) {
      sum[power] += (double)s.mass * pow(x, power) * length / 17.0;
    }
  }
  FBT_NEAR_REL(sum[0], 17536.614, 1e-6);
  FBT_NEAR_REL(sum[1], 362132.653, 1e-6);
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 4;
  keep.count[FB_KIND_AXIAL] = 1;
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_NEAR_REL(beam.mass, 16844.752 * factor, FBT_TOL(1e-6, 1e-5));
  FBT_NEAR_REL(modes.rigid_mass[0], 16844.752 * factor, FBT_TOL(1e-6, 1e-5));
  FBT_NEAR_REL(modes.rigid_mass[4], 1.11816e7 * factor, 1e-3); /* trapezoids lie 6e-4 lower */
  level.effects = FB_EFFECTS_FULL;
  level.base = FB_BASE_PRESCRIBED;
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_NEAR_REL(shape.c[0] / shape.mass - FB_R(1.5), 20.5073, 1e-3);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
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

/* E12.7: steps by the advice miss a swinging oscillator's exact motion (its modes at rest) by what was wanted, within a
   factor of 3. */
TEST(advised_steps_err_as_wanted)
{
  static const double wanted[3] = {1e-1, 1e-2, 1e-3};
  for (int run = 0; run < 18; run++) {
    const fb_scheme scheme = (fb_scheme)(run % 3);
    const double zeta = run / 3 % 2 ? 0.02 : 0.0, duration = 20.0, tolerance = wanted[run / 6];
    fb_real amplitude[4] = {FB_R(1.0), FB_R(0.3), 0, 0};
    fb_state state;
    fb_input input;
    double dt, most = 0.0;
    int steps;
    particle_on_springs(0.0, 4.0, 90.0, zeta);
    body.allow_long_step = 1;
    memset(&input, 0, sizeof input);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &body, &state, &input), FB_OK);
    dt = (double)fb_spectrum_step(&spectrum, scheme, amplitude, (fb_real)duration, (fb_real)tolerance);
    FBT_TRUE(dt > 0.0);
    steps = (int)ceil(duration / dt);
    state.q[0] = FB_R(1.0);
    state.q[1] = FB_R(0.3);
    for (int i = 1; i <= steps; i++) {
      static fb_rk4_work rk4;
      static fb_implicit_work implicit;
      const fb_real h = (fb_real)dt;
      double error = 0.0;
      FBT_INT_EQ(scheme == FB_SCHEME_RK4        ? fb_rk4_step(&body, &state, &rk4, &input, &input, &input, h)
                 : scheme == FB_SCHEME_MIDPOINT ? fb_midpoint_step(&body, &state, &implicit, &input, h, 0)
                                                : fb_sdirk_step(&body, &state, &implicit, &input, &input, h, 0),
                 FB_OK);
      for (int a = 0; a < 2; a++) {
        const double omega = sqrt(a ? 90.0 : 4.0), decay = zeta * omega, own = omega * sqrt(1.0 - zeta * zeta);
        const double t = i * dt, size = a ? 0.3 : 1.0;
        const double q = size * exp(-decay * t) * (cos(own * t) + decay / own * sin(own * t));
        error += fabs((double)state.q[a] - q);
      }
      most = fmax(most, error);
    }
    FBT_BELOW(most, 3.0 * tolerance);
    FBT_BELOW(tolerance / 3.0, most);
  }
  FBT_NEAR_ABS(fb_spectrum_step(&spectrum, (fb_scheme)7, NULL, FB_R(1.0), FB_R(0.1)), 0.0, 0.0);
  FBT_NEAR_ABS(fb_spectrum_step(&spectrum, FB_SCHEME_RK4, NULL, FB_R(0.0), FB_R(0.1)), 0.0, 0.0);
  FBT_NEAR_ABS(fb_spectrum_step(&spectrum, FB_SCHEME_RK4, NULL, FB_R(1.0), (fb_real)NAN), 0.0, 0.0);
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
  FBT_INT_EQ(fb_body_spectrum(NULL, &work, &body, &state, &input), FB_ERR_NULL);
  FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &body, NULL, &input), FB_ERR_NULL);
  input.w[2] = (fb_real)NAN;
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_NOT_FINITE);
  input.w[2] = FB_R(1.99); /* rests 49.6 m out: beyond the limit of 10 m */
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_RANGE);
  FBT_TRUE(memcmp(&state, &kept, sizeof state) == 0);
  state.q[0] = (fb_real)NAN;
  FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &body, &state, &input), FB_ERR_NOT_FINITE);
}

SUITE(analyse, RUN(spectrum_of_a_spinning_oscillator_is_closed_form), RUN(damped_modes_have_their_ratios),
      RUN(free_tops_nutate_as_euler_says), RUN(damped_spinning_satellite_has_its_closed_form),
      RUN(linear_models_answer_as_the_body_does), RUN(step_limits_are_those_of_the_spectrum),
      RUN(advised_steps_err_as_wanted), RUN(nrel_blade_has_the_published_figures), RUN(analysis_refuses_bad_input))
