/* >>integrate: the step limits of the integrators; what is refused. */
#include "integrate.h"

/* Largest deflection in the last quarter of many steps over that in the first; huge if a step failed. The body spins
   about axis x or z of its frame, its mass center at rest. */
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

/* E8.8, E11.1: at the limit the motion stays bounded, 3 % beyond it leaves the range, for a free and a held root (the
   free boom is stiffer: rigid-elastic coupling). With spin up to five times the first bending frequency (3.8 rad/s),
   about the boom and across it, and with damping the limit is on the safe side. */
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

/* Interface: bad input returns its status and changes nothing; the same calls give the same bits. */
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

/* ---- all integrators */

/* E11.6, E11.11: steps just within the limits on light hubs, spinning, tension and all: no integrator leaves the model
   or blows up. A step may be refused when the motion has come to spin or drift faster. */
TEST(steps_within_the_limit_are_stable)
{
  static const fb_base base[] = {FB_BASE_FREE, FB_BASE_PRESCRIBED, FB_BASE_PINNED, FB_BASE_HINGED};
  for (int k = 0; k < 24; k++) {
    const integrator which = (integrator)(MIDPOINT + k % 3);
    const double spin = k / 3 % 2 ? 2.0 : 0.5;
    const fb_real v[3] = {0}, w[3] = {0, 0, (fb_real)spin};
    fb_state state;
    fb_input input;
    double dt, largest = 0.0;
    fb_status status = FB_OK;
    strained(base[k / 6], FBT_MOMENTUM, 3e7, 1);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    for (int a = 0; a < 3; a++) {
      state.q[a] = FB_R(1e-3);
    }
    FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, w, NULL), FB_OK);
    memset(&input, 0, sizeof input);
    input.w[2] = (fb_real)spin;
    dt = 0.98 * (double)(which == EXPONENTIAL ? fb_exponential_limit(&body, (fb_real)spin, FB_R(40.0))
                                              : fb_implicit_limit(&body, (fb_real)spin, FB_R(40.0)));
    prepare(which, dt);
    for (int i = 0; i < 200 && status == FB_OK; i++) {
      status = step(which, &state, &input, &input, &input, dt);
      for (int a = 0; a < body.n; a++) {
        largest = fmax(largest, fabs((double)state.q[a] * (double)body.reach[a]));
      }
    }
    FBT_TRUE(status == FB_OK || status == FB_ERR_STEP);
    FBT_BELOW(largest, 0.5);
  }
}

/* E11.11: without a quadratic field and without strain stations the exponential scheme's limit is the same part of a
   turn at every spin. */
TEST(the_exponential_limit_is_a_part_of_a_turn)
{
  static const fb_base base[] = {FB_BASE_FREE, FB_BASE_PRESCRIBED, FB_BASE_PINNED};
  for (int k = 0; k < 3; k++) {
    boom(FB_EFFECTS_SPIN, base[k], 2, 2, 0, 0.0);
    FBT_NEAR_REL(100.0 * (double)fb_exponential_limit(&body, FB_R(100.0), 0), fb_exponential_limit(&body, FB_R(1.0), 0),
                 8.0 * (double)FB_EPSILON);
  }
}

/* E11.11: by how much the tension of its own mass changes the frequency of a spinning cantilever's first mode, T S/(2
   w) per spin squared with T = m L^2/2 and S = int psi' psi' dx = sigma b (2 + sigma b L)/(m L), in the softer plane;
   above some spin that alone sets the limit.
   Source: Blevins, Formulas for natural frequency and mode shape, table C-1. */
TEST(the_exponential_limit_knows_the_tension)
{
  const double sigma_b = 0.734095514 * 1.875104069 / 10.0, w = 1.875104069 * 1.875104069 / 100.0 * sqrt(9000.0 / 1.2);
  const double expected = 0.25 * 10.0 * sigma_b * (2.0 + sigma_b * 10.0) / w, spin = 1e4;
  fb_modes_desc keep;
  strained_beam(2, 1e5, 9000.0, 0);
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 1;
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_strain(&shape, 0, &beam, &modes), FB_OK);
  strained_body(FB_BASE_PRESCRIBED, FBT_MOMENTUM);
  FBT_NEAR_REL(body.limit_tension, expected, 1e-3); /* of two elements */
  FBT_NEAR_REL(fb_exponential_limit(&body, (fb_real)spin, 0), 1.0 / (expected * spin * spin), 1e-3);
}

/* E11.11: of several modes in each plane, by brute force: the tension of the beam's mass per spin squared, by half the
   root of the largest eigenvalue of S^2 against K, S from the slopes at the strain stations. */
TEST(the_tension_limit_counts_all_modes)
{
  fb_real S[16], A[16], K[16], X[16], d[4];
  fb_modes_desc keep;
  strained_beam(2, 1e5, 9000.0, 0);
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 2;
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, 4), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_strain(&shape, 0, &beam, &modes), FB_OK);
  strained_body(FB_BASE_PRESCRIBED, FBT_MOMENTUM);
  memset(S, 0, sizeof S);
  for (int i = 0; i < body.n_strain_row; i++) {
    for (int j = 0; j < body.n_strain_row; j++) {
      const fb_strain_row *a = &body.strain_row[i], *b = &body.strain_row[j];
      for (int g = 0; g < body.n_strain && a->axis == b->axis && a->axis > 0; g++) {
        S[4 * a->a + b->a] += body.strain_weight[g] * a->slope[g] * b->slope[g];
      }
    }
  }
  memset(A, 0, sizeof A);
  for (int i = 0; i < 64; i++) {
    A[i / 4] += S[i / 16 * 4 + i % 4] * S[i % 4 * 4 + i / 4 % 4];
  }
  memcpy(K, shape.K, sizeof K);
  FBT_INT_EQ(fb_eig_gen_solve(d, X, A, K, 4), FB_OK);
  FBT_NEAR_REL(body.limit_tension, 0.5 * (double)shape.stretch * sqrt((double)d[3]), 1e-3);
  FBT_TRUE(fabs((double)S[0 * 4 + 1]) + fabs((double)S[0 * 4 + 2]) + fabs((double)S[0 * 4 + 3]) > 0.1 * (double)S[0]);
}

static int is_too_long(integrator which, const fb_state *state, const fb_input *input, double dt)
{
  fb_state moved = *state;
  prepare(which, dt);
  return step(which, &moved, input, input, input, dt) == FB_ERR_STEP;
}

/* The largest step of rk4 that is not refused, by bisection. */
static double largest_step(const fb_state *state, const fb_input *input)
{
  double low = 1e-6, high = 1.0;
  for (int k = 0; k < FBT_TOL(60, 40); k++) {
    const double dt = sqrt(low * high);
    const int too_long = is_too_long(RK4, state, input, dt);
    high = too_long ? dt : high;
    low = too_long ? low : dt;
  }
  return low;
}

/* Adds the strain u_x' = e all along the beam, by least squares at the stations. */
static void stretch_evenly(fb_real *q, double e)
{
  fb_real A[FB_MAX_MODES * FB_MAX_MODES] = {0}, sum[FB_MAX_MODES] = {0};
  for (int a = 0; a < body.n; a++) {
    A[a * body.n + a] = FB_R(1e-10);
  }
  for (int i = 0; i < body.n_strain_row; i++) {
    const fb_strain_row *const row = &body.strain_row[i];
    for (int j = 0; j < body.n_strain_row && row->axis == 0; j++) {
      const fb_strain_row *const other = &body.strain_row[j];
      for (int g = 0; g < body.n_strain && other->axis == 0; g++) {
        A[row->a * body.n + other->a] += row->slope[g] * other->slope[g];
        sum[row->a] += i == j ? (fb_real)e * row->slope[g] : FB_R(0.0);
      }
    }
  }
  FBT_INT_EQ(fb_chol_factor(A, body.n), FB_OK);
  fb_chol_solve(sum, A, sum, body.n);
  for (int a = 0; a < body.n; a++) {
    q[a] += sum[a];
  }
}

/* Adds a deflection along y (axis 1) or z (2), the same in either; returns its largest slope. */
static double deflect(fb_real *q, int axis, double size)
{
  double slope[FBI_MAX_STRAINS] = {0}, largest = 0.0;
  for (int i = 0, k = 0; i < body.n_strain_row; i++) {
    const fb_strain_row *const row = &body.strain_row[i];
    if (row->axis == axis) {
      const double part = size / (1.0 + 3.0 * k++);
      q[row->a] += (fb_real)part;
      for (int g = 0; g < body.n_strain; g++) {
        slope[g] += part * (double)row->slope[g];
        largest = fmax(largest, fabs(slope[g]));
      }
    }
  }
  return largest;
}

/* The highest frequency [rad/s] about a deflected state, from the linear model. */
static double fastest(const fb_state *state, const fb_input *input)
{
  static fb_analyse_work work;
  static fb_spectrum spectrum;
  FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, &spectrum, state, input), FB_OK);
  return hypot((double)spectrum.re[spectrum.n - 1], (double)spectrum.im[spectrum.n - 1]);
}

/* E8.8: the largest accepted step h of a beam at rest that is deflected or stretched. A deflection in any plane counts
   alike; its stretch s^2/2 counts as any other, and no more when the beam is compressed by as much; a slope s alone
   counts with that: (1/h - 1/h_0)^2 is twice 1/h^2 - 1/h_0^2 of the strain s^2/2. No step is too long for the
   frequencies there are, and none is shorter by more than a fifth. */
TEST(deflection_and_stretch_shorten_the_step)
{
  fb_state none, state;
  fb_input input;
  double h0, h[3], slope, bent, stretched;
  strained(FB_BASE_PRESCRIBED, FBT_MOMENTUM, 1e5, 1);
  memset(&input, 0, sizeof input);
  FBT_INT_EQ(fb_state_init(&body, &none), FB_OK);
  h0 = largest_step(&none, &input);
  FBT_NEAR_REL(fb_rk4_limit(&body, 0, 0), h0, 16.0 * (double)FB_EPSILON);
  for (int k = 0; k < 3; k++) { /* along y, along z, between */
    state = none;
    (void)deflect(state.q, k == 1 ? 2 : 1, k == 2 ? 0.3 : 0.5);
    (void)deflect(state.q, 2, k == 2 ? 0.4 : 0.0);
    h[k] = largest_step(&state, &input);
    FBT_NEAR_REL(h[k], h[0], 16.0 * (double)FB_EPSILON);
    FBT_BELOW(h[k] * fastest(&state, &input), 2.83);
    FBT_BELOW(2.2, h[k] * fastest(&state, &input));
  }
  state = none;
  slope = deflect(state.q, 1, 0.5);
  stretch_evenly(state.q, -0.5 * slope * slope);
  bent = largest_step(&state, &input);
  state = none;
  stretch_evenly(state.q, 0.5 * slope * slope);
  stretched = largest_step(&state, &input);
  FBT_NEAR_REL(pow(h[0], -2.0) - pow(bent, -2.0), pow(stretched, -2.0) - pow(h0, -2.0), FBT_TOL(1e-8, 1e-3));
  FBT_NEAR_REL(pow(1.0 / bent - 1.0 / h0, 2.0), 2.0 * (pow(stretched, -2.0) - pow(h0, -2.0)), FBT_TOL(1e-8, 1e-3));
}

/* The step that an integrator's limit allows at this spin and this acceleration of O. */
static fb_real (*const longest_step[])(const fb_body *, fb_real, fb_real) = {fb_rk4_limit, fb_implicit_limit,
                                                                             fb_implicit_limit, fb_exponential_limit};
FBT_ONE_EACH(longest_step, INTEGRATORS);

static double limit_of(integrator which, double spin, double acceleration)
{
  const fb_real w = (fb_real)spin, a = (fb_real)acceleration;
  return (double)longest_step[which](&body, w, a);
}

typedef struct scene { /* what a base does, its limits' spin and acceleration of O */
  fb_base base;
  double push, circle, spin, drift, force, gravity;
} scene;

/* E11.1, E11.6, E11.11: the limits are asked at the spin there is and at the acceleration of O: of a held base that of
   its motion, v' + w x v, of a free one what a force gives it, or w^2 r about a mass center at the distance r; gravity
   with it where it does not fall. The speed at which a free body drifts counts for nothing. A step just below is taken,
   one just above refused; along each axis. */
TEST(steps_are_limited_by_what_the_base_does)
{
  static const scene scenes[] = {{FB_BASE_PRESCRIBED, 200, 0, 0, 0, 0, 100}, {FB_BASE_PRESCRIBED, 0, 3, 3, 0, 0, 0},
                                 {FB_BASE_FREE, 0, 0, 0, 0, 300, 0},         {FB_BASE_FREE, 0, 0, 0, 0, 0, 300},
                                 {FB_BASE_FREE, 0, 0, 20, 0, 0, 0},          {FB_BASE_FREE, 0, 0, 0, 5, 0, 0},
                                 {FB_BASE_FREE, 0, 0, 20, 0, 300, 0},        {FB_BASE_PINNED, 0, 0, 3, 0, 0, 300}};
  for (int k = 0; k < 3 * FBT_COUNT(scenes); k++) {
    const scene *const s = &scenes[k / 3];
    const int i = k % 3, j = (i + 1) % 3;
    double acceleration = s->push + s->circle * 100.0 + s->force + (s->base == FB_BASE_FREE ? 0.0 : s->gravity);
    fb_real w[3] = {0};
    fb_state state;
    fb_input input;
    if (i == 0) {
      boom(FB_EFFECTS_FULL | FB_EFFECT_GRAVITY, s->base, 2, 1, 0, 0.0);
    }
    memset(body_desc.gravity, 0, sizeof body_desc.gravity);
    body_desc.gravity[j] = (fb_real)s->gravity;
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &body_desc), FB_OK);
    memset(&input, 0, sizeof input);
    input.n_load = 1;
    input.load[0].force[i] = (fb_real)s->force * body.mass;
    input.v_dot[i] = (fb_real)s->push;
    w[i] = input.w[i] = (fb_real)s->spin;
    input.v[j] = (fb_real)(s->circle > 0.0 ? 100.0 : s->drift);
    if (s->base == FB_BASE_FREE && s->spin > 0.0) {
      fb_vec3_cross(input.v, body.c, w);
      for (int m = 0; m < 3; m++) {
        input.v[m] /= body.mass;
      }
      acceleration = s->force + s->spin * s->spin * sqrt((double)fb_vec3_dot(body.c, body.c)) / (double)body.mass;
    }
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_state_from_velocity(&body, &state, input.v, w, NULL), FB_OK);
    for (int m = 0; m < INTEGRATORS; m++) {
      const integrator which = (integrator)m;
      const double limit = limit_of(which, s->spin, acceleration), part = 64.0 * (double)FB_EPSILON;
      FBT_TRUE(!is_too_long(which, &state, &input, fmin(limit, 1e3) * (1.0 - part)));
      FBT_TRUE(limit > 1e3 || is_too_long(which, &state, &input, limit * (1.0 + part)));
    }
  }
}

/* E11.11: on a pin or a hinge, too, a hub lighter than its boom lets the exponential scheme gain no energy: it keeps
   it, or says that the step is too long. */
TEST(light_hubs_on_pins_and_hinges_gain_no_energy)
{
  int kept = 0, refused = 0;
  for (int run = 0; run < 16; run++) {
    const fb_base base = run % 2 ? FB_BASE_HINGED : FB_BASE_PINNED;
    const double dt = 0.008 * (1 << run / 2 % 4), size = run < 8 ? 0.02 : 0.4;
    const fb_real none[3] = {0}, w[3] = {0, 0, FB_R(0.25)};
    double energy, most = 0.0;
    fb_status status = FB_OK;
    fb_state state;
    boom(FB_EFFECTS_FULL, base, 2, 1, 1, 0.0);
    prepare(EXPONENTIAL, dt);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    for (int a = 0; a < 3; a++) {
      state.q[a] = (fb_real)(a == 1 ? -size : size) / body.reach[a];
    }
    FBT_INT_EQ(fb_state_from_velocity(&body, &state, none, w, NULL), FB_OK);
    energy = energy_of(&state);
    for (int k = 0; k < (int)(30.0 / dt) && status == FB_OK; k++) {
      status = step(EXPONENTIAL, &state, NULL, NULL, NULL, dt);
      most = fmax(most, energy_of(&state) / energy - 1.0);
    }
    FBT_TRUE(status == FB_OK || status == FB_ERR_STEP);
    FBT_BELOW(most, 0.02);
    kept += status == FB_OK;
    refused += status == FB_ERR_STEP;
  }
  FBT_TRUE(kept > 0 && refused > 0);
}

/* E11.15: what acts on the first body of a system accelerates its O, by which the quadratic field stiffens: steps are
   refused from the limit at that acceleration on, in every unit of mass. */
TEST(loads_shorten_the_steps_of_systems)
{
  static fb_system_desc tree;
  static fb_system system;
  static fb_system_work system_work;
  static fb_system_state first, state;
  static fb_system_input push;
  tree.n_body = 1;
  tree.joint[0].kind = FB_JOINT_FREE;
  tree.joint[0].parent = FB_GROUND;
  for (int light = 0; light < 2; light++) {
    const double acceleration = 300.0; /* [m/s^2] */
    fb_real limit;
    mass_unit = light ? FB_R(1e-3) : FB_R(1.0);
    boom(FB_EFFECTS_FULL, FB_BASE_FREE, 2, 2, 0, 0.0);
    mass_unit = FB_R(1.0);
    FBT_INT_EQ(fb_system_init(&system, &system_work, &body, &tree, 1), FB_OK);
    FBT_INT_EQ(fb_system_state_init(&system, &body, &first, &system_work, NULL, NULL), FB_OK);
    limit = fb_system_rk4_limit(&system, &body, 0, (fb_real)acceleration);
    FBT_BELOW(limit, 0.98 * (double)fb_system_rk4_limit(&system, &body, 0, 0));
    push.n_load = 1;
    push.load[0].load.force[1] = (fb_real)acceleration * body.mass;
    state = first;
    FBT_INT_EQ(fb_system_rk4_step(&system, &body, &state, &system_work, &push, &push, &push, FB_R(1.01) * limit),
               FB_ERR_STEP);
    FBT_INT_EQ(fb_system_rk4_step(&system, &body, &state, &system_work, &push, &push, &push, FB_R(0.99) * limit),
               FB_OK);
  }
}

/* Interface: fb_exponential_check walks G by the body's number of strain stations: a count beyond the tables is told
   before that. */
TEST(the_check_of_an_integrator_stays_within_its_tables)
{
  static const int counts[] = {-1, FBI_MAX_STRAINS + 1, 1 << 30};
  strained_beam(1, 1e4, 0.0, 0);
  strained_body(FB_BASE_PRESCRIBED, FBT_MOMENTUM);
  prepare(EXPONENTIAL, 0.01);
  FBT_TRUE(body.n_strain > 0 && exponential.n_axial > 0);
  for (int k = 0; k < FBT_COUNT(counts); k++) {
    const int n = body.n_strain;
    body.n_strain = counts[k];
    FBT_INT_EQ(fb_exponential_check(&exponential, &body), FB_ERR_CAPACITY);
    body.n_strain = n;
  }
  exponential.axial[0] = body.n;
  FBT_INT_EQ(fb_exponential_check(&exponential, &body), FB_ERR_VALUE);
  strained_beam(1, 1e4, 0.0, 1); /* more than one axial coordinate, a row of G each */
  strained_body(FB_BASE_PRESCRIBED, FBT_MOMENTUM);
  prepare(EXPONENTIAL, 0.01);
  FBT_TRUE(exponential.n_axial > 1 && body.n_strain < FBI_MAX_STRAINS);
  FBT_INT_EQ(fb_exponential_check(&exponential, &body), FB_OK);
  exponential.G[FBI_MAX_STRAINS + body.n_strain - 1] = (fb_real)NAN;
  FBT_INT_EQ(fb_exponential_check(&exponential, &body), FB_ERR_VALUE);
}

/* E11.26: a step in which a body at rest comes to turn by more than half a radian is refused by every integrator, and
   the state is as before; a tenth of that torque goes through, and gives the spin of a rigid body, t T / J. */
TEST(steps_of_a_body_that_turn_too_far_are_refused)
{
  fb_input input;
  boom(FB_EFFECTS_LINEAR, FB_BASE_HINGED, 0, 0, 0, 0.0);
  memset(&input, 0, sizeof input);
  input.n_load = 1;
  for (int which = 0; which < (int)FB_INTEGRATOR_COUNT; which++) {
    const double J = 50.0 + 12.0 * 100.0 / 3.0; /* [kg m^2] about the hinge */
    fb_state state, before;
    fb_motion motion;
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    before = state;
    prepare((integrator)which, 1.0);
    input.load[0].torque[2] = (fb_real)(1.1 * J);
    FBT_INT_EQ(step((integrator)which, &state, &input, &input, &input, 1.0), FB_ERR_STEP);
    FBT_TRUE(memcmp(&state, &before, sizeof state) == 0);
    input.load[0].torque[2] = (fb_real)(0.11 * J);
    FBT_INT_EQ(step((integrator)which, &state, &input, &input, &input, 1.0), FB_OK);
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, NULL), FB_OK);
    FBT_NEAR_REL(motion.w[2], 0.11, FBT_TOL(1e-12, 1e-5));
  }
}

/* E11.15: a rigid body at rest that nothing acts on takes any step. */
TEST(steps_of_a_rigid_system_have_no_limit)
{
  static fb_system_desc tree;
  static fb_system system;
  static fb_system_work work;
  static fb_system_state state;
  boom(FB_EFFECTS_LINEAR, FB_BASE_FREE, 0, 0, 0, 0.0);
  FBT_INT_EQ(body.n, 0);
  tree.n_body = 1;
  tree.joint[0].kind = FB_JOINT_FREE;
  tree.joint[0].parent = FB_GROUND;
  FBT_INT_EQ(fb_system_init(&system, &work, &body, &tree, 1), FB_OK);
  FBT_INT_EQ(fb_system_state_init(&system, &body, &state, &work, NULL, NULL), FB_OK);
  FBT_TRUE(fb_system_rk4_limit(&system, &body, 0, 0) == FB_HUGE);
  FBT_INT_EQ(fb_system_rk4_step(&system, &body, &state, &work, NULL, NULL, NULL, FB_R(100.0)), FB_OK);
  FBT_INT_EQ(fb_system_sdirk_step(&system, &body, &state, &work, NULL, NULL, FB_R(100.0), 0), FB_OK);
}

/* E11.4 to E11.10: what a stepper cannot do is refused, and the state is as before. */
TEST(every_integrator_refuses_bad_input)
{
  fb_state state, before;
  fb_input one, other;
  fb_exponential untouched;
  strained(FB_BASE_FREE, FBT_MOMENTUM, 1e5, 1);
  start(&state, 0.05, 1.0);
  before = state;
  memset(&one, 0, sizeof one);
  other = one;
  other.n_load = 1;
  FBT_INT_EQ(fb_midpoint_step(&body, &state, &implicit_work, NULL, FB_R(0.0), 0), FB_ERR_VALUE);
  FBT_INT_EQ(fb_midpoint_step(&body, &state, &implicit_work, NULL, (fb_real)NAN, 0), FB_ERR_VALUE);
  FBT_INT_EQ(fb_midpoint_step(&body, &state, &implicit_work, NULL, FB_R(0.01), -1), FB_ERR_VALUE);
  FBT_INT_EQ(fb_midpoint_step(&body, &state, &implicit_work, NULL, FB_R(0.01), 51), FB_ERR_VALUE);
  FBT_INT_EQ(fb_midpoint_step(&body, &state, NULL, NULL, FB_R(0.01), 0), FB_ERR_NULL);
  FBT_INT_EQ(fb_midpoint_step(&body, &state, &implicit_work, NULL, FB_R(10.0), 0), FB_ERR_STEP);
  FBT_INT_EQ(fb_sdirk_step(&body, &state, &implicit_work, NULL, NULL, FB_R(10.0), 0), FB_ERR_STEP);
  FBT_INT_EQ(fb_sdirk_step(&body, &state, &implicit_work, &one, &other, FB_R(0.001), 0), FB_ERR_VALUE);
  FBT_INT_EQ(fb_sdirk_step(&body, &state, &implicit_work, &one, NULL, FB_R(0.001), 0), FB_ERR_NULL);
  other.load[0].node = 77;
  FBT_INT_EQ(fb_sdirk_step(&body, &state, &implicit_work, &other, &other, FB_R(0.001), 0), FB_ERR_CAPACITY);
  prepare(EXPONENTIAL, 10.0);
  FBT_INT_EQ(fb_exponential_step(&body, &exponential, &state, &exponential_work, NULL, NULL, NULL), FB_ERR_STEP);
  FBT_INT_EQ(fb_exponential_step(&body, &exponential, &state, &exponential_work, &other, NULL, NULL), FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_exponential_step(&body, NULL, &state, &exponential_work, NULL, NULL, NULL), FB_ERR_NULL);
  FBT_TRUE(memcmp(&state, &before, sizeof state) == 0);
  { /* work means nothing between steps, whatever was left in it */
    fb_state clean = before, dirty = before;
    prepare(EXPONENTIAL, 0.001);
    memset(&exponential_work, 0, sizeof exponential_work);
    memset(&implicit_work, 0, sizeof implicit_work);
    for (int which = MIDPOINT; which < INTEGRATORS; which++) {
      clean = dirty = before;
      FBT_INT_EQ(step((integrator)which, &clean, NULL, NULL, NULL, 0.001), FB_OK);
      memset(&exponential_work, 0xff, sizeof exponential_work);
      memset(&implicit_work, 0xff, sizeof implicit_work);
      FBT_INT_EQ(step((integrator)which, &dirty, NULL, NULL, NULL, 0.001), FB_OK);
      FBT_TRUE(memcmp(&clean, &dirty, sizeof clean) == 0);
    }
  }
  { /* a base that drifts does no harm */
    const fb_real fast[3] = {0, FB_R(300.0), 0}, none[3] = {0};
    fb_state drifting = before;
    FBT_INT_EQ(fb_state_from_velocity(&body, &drifting, fast, none, NULL), FB_OK);
    prepare(EXPONENTIAL, 0.01);
    FBT_INT_EQ(step(EXPONENTIAL, &drifting, NULL, NULL, NULL, 0.01), FB_OK);
    FBT_INT_EQ(step(MIDPOINT, &drifting, NULL, NULL, NULL, 0.01), FB_OK);
  }
  untouched = exponential;
  FBT_INT_EQ(fb_exponential_init(&exponential, &body_work, &body, -FB_R(1.0)), FB_ERR_VALUE);
  FBT_INT_EQ(fb_exponential_init(&exponential, &body_work, NULL, FB_R(1.0)), FB_ERR_NULL);
  FBT_TRUE(memcmp(&untouched, &exponential, sizeof untouched) == 0);
  FBT_TRUE(fb_implicit_limit(&body, (fb_real)NAN, 0) == FB_R(0.0));
  FBT_TRUE(fb_exponential_limit(&body, 0, 0) == FB_HUGE);
}

SUITE(integrate_limits, RUN(light_hubs_on_pins_and_hinges_gain_no_energy), RUN(steps_are_limited_by_what_the_base_does),
      RUN(deflection_and_stretch_shorten_the_step), RUN(steps_within_the_limit_are_stable),
      RUN(the_exponential_limit_is_a_part_of_a_turn), RUN(the_exponential_limit_knows_the_tension),
      RUN(the_tension_limit_counts_all_modes), RUN(loads_shorten_the_steps_of_systems),
      RUN(steps_of_a_rigid_system_have_no_limit), RUN(every_integrator_refuses_bad_input),
      RUN(the_step_limit_is_the_stability_boundary), RUN(the_step_limit_knows_the_acceleration_of_a_far_origin),
      RUN(steps_of_a_body_that_turn_too_far_are_refused), RUN(the_check_of_an_integrator_stays_within_its_tables),
      RUN(rk4_refuses_bad_input_and_repeats_itself))
