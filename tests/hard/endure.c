/* endure.c - very many steps: conservation, resonance, sums in single precision, decay to nothing. */
#define _POSIX_C_SOURCE 200112L /* clock_gettime */
#include "hard.h"
#include "../../examples/common/clock.h"
#include "../../examples/common/stepper.h"

/* A boom with bending modes of both planes on a hub that is not much heavier, tumbling. */
static void tumbler(fb_body *body, fb_state *state)
{
  static hard_craft craft;
  static const double w[3] = {0.4, 0.8, -0.6};
  double v[3];
  fb_real q_dot[FB_MAX_MODES] = {FB_R(2.0), -FB_R(1.0)}; /* 1.5 % of the energy */
  hard_craft_init(&craft, BOOM_LENGTH, BOOM_LINE, BOOM_EI);
  craft.keep.count[FB_KIND_BEND_Y] = craft.keep.count[FB_KIND_BEND_Z] = 1;
  craft.hub_mass = 20.0;
  craft.hub_inertia[0] = 40.0;
  craft.hub_inertia[1] = 30.0;
  craft.hub_inertia[2] = 50.0;
  hard_craft_build(body, &craft);
  for (int i = 0; i < 3; i++) { /* the mass center rests: positions stay small */
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    v[i] = -(w[j] * (double)hard_shape.c[k] - w[k] * (double)hard_shape.c[j]) / (double)hard_shape.mass;
    for (int a = 0; a < body->n; a++) {
      v[i] -= (double)hard_shape.P[3 * a + i] * (double)q_dot[a] / (double)hard_shape.mass;
    }
  }
  hard_start(body, state, v, w, q_dot);
}

/* That boom with its modes as modes of curvature, bent until its tip is turned by more than 100 degrees. */
static void bent_tumbler(fb_body *body, fb_state *state)
{
  static hard_craft craft;
  static const double w[3] = {0.4, 0.8, -0.6}, angle[2] = {2.0, 0.6}; /* [rad] of the tip */
  double v[3] = {0.0, 0.0, 0.0};
  fb_momentum first;
  hard_craft_init(&craft, BOOM_LENGTH, BOOM_LINE, BOOM_EI);
  craft.keep.count[FB_KIND_BEND_Y] = craft.keep.count[FB_KIND_BEND_Z] = 1;
  craft.keep.line_points = 4;
  craft.level.effects = FB_EFFECTS_LARGE;
  craft.hub_mass = 20.0;
  craft.hub_inertia[0] = 40.0;
  craft.hub_inertia[1] = 30.0;
  craft.hub_inertia[2] = 50.0;
  hard_craft_build(body, &craft);
  hard_must(fb_state_init(body, state), "state");
  for (int a = 0; a < 2; a++) {
    const fb_real *const turn = hard_shape.node[HARD_TIP].theta + 3 * a;
    state->q[a] = (fb_real)(angle[a] / hypot((double)turn[1], (double)turn[2]));
  }
  for (int again = 0; again < 2; again++) { /* the mass center rests */
    const fb_real speed[3] = {(fb_real)v[0], (fb_real)v[1], (fb_real)v[2]};
    const fb_real rate[3] = {(fb_real)w[0], (fb_real)w[1], (fb_real)w[2]}, q_dot[FB_MAX_MODES] = {0};
    hard_must(fb_state_from_velocity(body, state, speed, rate, q_dot), "state");
    hard_must(fb_body_momentum_eval(body, &first, state, NULL), "momentum");
    for (int i = 0; i < 3; i++) {
      v[i] -= (double)first.linear[i] / (double)hard_shape.mass;
    }
  }
}

/* ---- conservation */

typedef struct drift {
  double energy, momentum, length; /* of the energy, the angular momentum, the quaternion's length, relative */
} drift;

static void drift_note(drift *d, const fb_body *body, const fb_state *state, double energy, const fb_momentum *first)
{
  fb_momentum now;
  double length = 0.0;
  for (int i = 0; i < 4; i++) {
    length += (double)state->quat[i] * (double)state->quat[i];
  }
  d->energy = fmax(d->energy, fabs(hard_energy(body, state) / energy - 1.0));
  d->length = fmax(d->length, fabs(sqrt(length) - 1.0));
  d->momentum = fb_body_momentum_eval(body, &now, state, NULL) == FB_OK
                    ? fmax(d->momentum, hard_difference(now.angular, first->angular, 3) / hard_length(first->angular))
                    : HUGE_VAL;
}

typedef enum way { BY_MIDPOINT, BY_RK4, BY_FORGETFUL_RK4, BY_PLAIN_RK4, BY_VELOCITIES, BY_EULER } way;

/* What one would write: the state is place, attitude and q with their velocities v, w, q_dot, here in the members of
   the momenta u, L, pi; their rates are the accelerations of the body. */
static int velocity_rates(const fb_body *body, fb_state *rate, const fb_state *at)
{
  fb_state momenta = *at;
  fb_motion motion;
  fb_real R[9], turn[4] = {0};
  if (fb_quat_normalize(momenta.quat) != FB_OK ||
      fb_state_from_velocity(body, &momenta, at->u, at->L, at->pi) != FB_OK ||
      fb_body_motion_eval(body, &motion, &momenta, NULL) != FB_OK) {
    return 0;
  }
  fb_quat_to_mat33(R, momenta.quat);
  fb_mat33_mul_vec3(rate->rho, R, at->u);
  memcpy(turn + 1, at->L, 3 * sizeof *turn);
  fb_quat_mul(rate->quat, momenta.quat, turn);
  fb_vec3_cross(rate->u, at->u, at->L); /* v_dot of body axes, a - w x v */
  for (int i = 0; i < 4; i++) {
    rate->quat[i] *= FB_R(0.5);
  }
  for (int i = 0; i < 3; i++) {
    rate->u[i] += motion.acceleration[i];
    rate->L[i] = motion.w_dot[i];
  }
  for (int a = 0; a < body->n; a++) {
    rate->q[a] = at->pi[a];
    rate->pi[a] = motion.q_ddot[a];
  }
  return 1;
}

/* A step of the classical integrator for them, from the state of momenta and back to it. */
static int velocity_rk4(const fb_body *body, fb_state *state, double dt)
{
  static const double part[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
  static fb_state from, sum, rate;
  fb_motion motion;
  if (fb_body_motion_eval(body, &motion, state, NULL) != FB_OK) {
    return 0;
  }
  from = *state;
  memcpy(from.u, motion.v, sizeof from.u);
  memcpy(from.L, motion.w, sizeof from.L);
  memcpy(from.pi, motion.q_dot, (size_t)body->n * sizeof *from.pi);
  sum = rate = from;
  for (int stage = 0; stage < 4; stage++) {
    fb_state at = from;
    hard_advance(&at, part[stage] * dt, &rate, body->n);
    if (!velocity_rates(body, &rate, &at)) {
      return 0;
    }
    hard_advance(&sum, weight[stage] * dt, &rate, body->n);
  }
  *state = sum;
  return fb_quat_normalize(state->quat) == FB_OK && fb_state_from_velocity(body, state, sum.u, sum.L, sum.pi) == FB_OK;
}

static int advance(const fb_body *body, fb_state *state, way how, double dt)
{
  static fb_implicit_work implicit;
  static fb_rk4_work rk4;
#if FB_SINGLE
  if (how == BY_FORGETFUL_RK4) {
    memset(state->lost_rho, 0, sizeof state->lost_rho);
    memset(state->lost_quat, 0, sizeof state->lost_quat);
    memset(state->lost_u, 0, sizeof state->lost_u);
    memset(state->lost_L, 0, sizeof state->lost_L);
    memset(state->lost_h, 0, sizeof state->lost_h);
    memset(state->lost_q, 0, sizeof state->lost_q);
    memset(state->lost_pi, 0, sizeof state->lost_pi);
  }
#endif
  if (how == BY_PLAIN_RK4) {
    return hard_rk4(body, state, dt);
  }
  if (how == BY_VELOCITIES) {
    return velocity_rk4(body, state, dt);
  }
  if (how == BY_EULER) {
    return hard_euler(body, state, NULL, dt);
  }
  return (how == BY_MIDPOINT ? fb_midpoint_step(body, state, &implicit, NULL, (fb_real)dt, 4)
                             : fb_rk4_step(body, state, &rk4, NULL, NULL, NULL, (fb_real)dt)) == FB_OK;
}

static drift conserve(void (*make)(fb_body *body, fb_state *state), way how, double dt, double steps)
{
  static fb_body body;
  fb_state state;
  fb_momentum first;
  drift d = {0.0, 0.0, 0.0};
  double energy;
  int well = 1;
  make(&body, &state);
  energy = hard_energy(&body, &state);
  hard_must(fb_body_momentum_eval(&body, &first, &state, NULL), "momentum");
  for (double k = 1; k <= steps && well; k++) {
    well = advance(&body, &state, how, dt);
    if (fmod(k, 1000.0) < 0.5) {
      drift_note(&d, &body, &state, energy, &first);
      hard_progress(k, steps);
    }
  }
  if (!well) {
    d.energy = d.momentum = d.length = HUGE_VAL;
  }
  return d;
}

static void report(hard_row *row, const char *name, const char *measure, double figure, double bound, const char *naive,
                   double naive_figure)
{
  row->name = name;
  row->measure = measure;
  row->figure = figure;
  row->bound = bound;
  row->naive = naive;
  row->naive_figure = naive_figure;
  hard_report(row);
}

void hard_long(int brief)
{
  const double dt = 0.05, steps = brief ? 2e5 : 1e7;
  drift ours, plain, velocities;
  hard_row row = {.what = "a flexible body tumbles freely, implicit midpoint rule", .degree = "steps"};
  ours = conserve(tumbler, BY_MIDPOINT, dt, steps);
  plain = conserve(tumbler, BY_PLAIN_RK4, dt, fmin(steps, 1e6));
  velocities = conserve(tumbler, BY_VELOCITIES, dt, fmin(steps, 1e6));
  row.hard = row.steps = steps;
  row.time = steps * dt;
  row.periods = row.time * HARD_FIRST / (2.0 * HARD_PI);
  report(&row, "long energy", "change of the energy", ours.energy, 1e-3, "rk4 at the same step, 1e6 at most",
         plain.energy);
  /* P and L are the state and nothing acts: what rounds is L + rho x P, three times, and its difference from the
     first */
  report(&row, "long momentum", "change of the angular momentum", ours.momentum, 4.0 * HARD_EPSILON,
         "velocities as state, rk4 at the same step, 1e6 at most", velocities.momentum);
  report(&row, "long quaternion", "length of the quaternion less 1", ours.length, HARD_TOL(1e-15, 1e-6),
         "rk4 at the same step, the quaternion as it comes, 1e6 at most", plain.length);
}

void hard_long_bent(int brief)
{
  const double dt = 1e-3, steps = brief ? 1e5 : 1e7;
  drift ours, euler, velocities;
  hard_row row = {.what = "a boom tumbles freely, bent until its tip is turned past a right angle, rk4",
                  .degree = "steps"};
  ours = conserve(bent_tumbler, BY_RK4, dt, steps);
  euler = conserve(bent_tumbler, BY_EULER, dt, fmin(steps, 1e5));
  velocities = conserve(bent_tumbler, BY_VELOCITIES, dt, fmin(steps, 1e5));
  row.hard = row.steps = steps;
  row.time = steps * dt;
  row.periods = row.time * HARD_FIRST / (2.0 * HARD_PI);
  report(&row, "long bent energy", "change of the energy", ours.energy, HARD_TOL(1e-5, 1e-3),
         "explicit Euler at the same step, 1e5 at most", euler.energy);
  report(&row, "long bent momentum", "change of the angular momentum", ours.momentum, 4.0 * HARD_EPSILON,
         "velocities as state, rk4 at the same step, 1e5 at most", velocities.momentum);
}

/* ---- resonance */

enum { PER_CYCLE = 12 };

/* A cantilever driven at the tip at its first frequency: amplitude and phase over the last cycle against F/(2 zeta
   omega^2), a quarter behind, relative. */
static double resonance(fb_integrator integrator, double zeta, double cycles)
{
  static hard_craft craft;
  static fb_body body;
  static fb_body_work work;
  static fb_stepper by;
  static fb_exponential exponential;
  static fb_input input[2 * PER_CYCLE + 3];
  const double amplitude = 0.05; /* [m] of the tip */
  double omega, psi, force, re = 0.0, im = 0.0, dt;
  fb_state state;
  hard_craft_init(&craft, BOOM_LENGTH, BOOM_LINE, BOOM_EI);
  craft.keep.count[FB_KIND_BEND_Y] = 1;
  craft.level.base = FB_BASE_PRESCRIBED;
  craft.level.effects = FB_EFFECTS_LINEAR | FB_EFFECT_DAMPING;
  craft.level.zeta[0] = (fb_real)zeta;
  hard_craft_build(&body, &craft);
  omega = sqrt((double)hard_shape.K[0]);
  psi = (double)hard_shape.node[HARD_TIP].psi[1];
  dt = 2.0 * HARD_PI / (omega * PER_CYCLE);
  force = 2.0 * zeta * omega * omega * amplitude / (psi * psi);
  for (int i = 0; i < HARD_COUNT(input); i++) {
    input[i].n_load = 1;
    input[i].load[0].node = HARD_TIP;
    input[i].load[0].axes = FB_AXES_BODY;
    input[i].load[0].force[1] = (fb_real)(force * sin(HARD_PI * (i % (2 * PER_CYCLE)) / PER_CYCLE));
  }
  hard_must(fb_state_init(&body, &state), "state");
  hard_must(body_stepper(&by, &exponential, &work, &body, &state, input, integrator, dt), "integrator");
  for (double cycle = 0; cycle < cycles; cycle++) {
    re = im = 0.0;
    for (int k = 0; k < PER_CYCLE; k++) {
      const double phase = 2.0 * HARD_PI * (k + 1) / PER_CYCLE;
      by.desc.input = &input[2 * k];
      if (fb_stepper_step(&by) != FB_OK) {
        return HUGE_VAL;
      }
      re += 2.0 / PER_CYCLE * cos(phase) * psi * (double)state.q[0];
      im += 2.0 / PER_CYCLE * sin(phase) * psi * (double)state.q[0];
    }
    hard_progress(cycle, cycles);
  }
  return hypot(re + amplitude, im) / amplitude;
}

void hard_resonance(int brief)
{
  const double cycles = brief ? 3e4 : 1e6, zeta = 3.0 / cycles;
  hard_row row = {.name = "resonance",
                  .what = "a hardly damped mode driven at its frequency, twelve steps a cycle, exponential scheme",
                  .degree = "amplification 1/(2 zeta)",
                  .measure = "amplitude and phase against F/(c omega), of it",
                  .bound = HARD_TOL(1e-3, 1e-1),
                  .naive = "rk4 at the same step"};
  row.hard = 0.5 / zeta;
  row.steps = cycles * PER_CYCLE;
  row.periods = cycles;
  row.time = cycles * 2.0 * HARD_PI / HARD_FIRST;
  row.figure = resonance(FB_INTEGRATOR_EXPONENTIAL, zeta, cycles);
  row.naive_figure = resonance(FB_INTEGRATOR_RK4, zeta, cycles);
  hard_report(&row);
}

/* ---- what sums lose in single precision */

void hard_rounding(int brief)
{
#if FB_SINGLE
  const double dt = 1e-4, steps = brief ? 1e6 : 5e6;
  drift ours, naive;
  hard_row row = {.name = "rounding",
                  .what = "a flexible body tumbles in single precision, short steps of rk4",
                  .degree = "steps per period of the first mode",
                  .measure = "change of energy and momenta",
                  .bound = 1e-5,
                  .naive = "float sums as they round, nothing kept"};
  row.hard = 2.0 * HARD_PI / HARD_FIRST / dt;
  row.steps = steps;
  row.time = steps * dt;
  row.periods = row.time * HARD_FIRST / (2.0 * HARD_PI);
  ours = conserve(tumbler, BY_RK4, dt, steps);
  naive = conserve(tumbler, BY_FORGETFUL_RK4, dt, steps);
  row.figure = fmax(ours.energy, ours.momentum);
  row.naive_figure = fmax(naive.energy, naive.momentum);
  hard_report(&row);
#else
  (void)brief; /* the same in double precision is in the cases of 1e7 steps */
#endif
}

/* ---- decay */

enum { MODES = 3, BLOCK = 100, BLOCKS = 2000 }; /* short: what moves is not to decay meanwhile */

static int subnormals(const fb_real *x, int n)
{
  int count = 0;
  for (int i = 0; i < n; i++) {
    count += fpclassify(x[i]) == FP_SUBNORMAL;
  }
  return count;
}

/* What one would write: x_k+1 = A x_k for each mode, its damped turn of a step. */
typedef struct recursion {
  fb_real A[FB_MAX_MODES][4], x[2 * FB_MAX_MODES];
  int n;
} recursion;

static void recursion_init(recursion *r, int n, double zeta, double dt)
{
  r->n = n;
  for (int k = 0; k < n; k++) {
    const double o = sqrt((double)hard_shape.K[k * (n + 1)]), c = exp(-zeta * o * dt), phase = o * dt;
    r->A[k][0] = r->A[k][3] = (fb_real)(c * cos(phase));
    r->A[k][1] = (fb_real)(c * sin(phase));
    r->A[k][2] = -r->A[k][1];
    r->x[2 * k] = FB_R(1e-3);
    r->x[2 * k + 1] = FB_R(0.0);
  }
}

static void recursion_step(recursion *r)
{
  for (int k = 0; k < r->n; k++) {
    const fb_real *A = r->A[k], a = r->x[2 * k], b = r->x[2 * k + 1];
    r->x[2 * k] = A[0] * a + A[1] * b;
    r->x[2 * k + 1] = A[2] * a + A[3] * b;
  }
}

/* The shortest of many blocks of steps [ns]. */
static double block_time(const fb_body *body, const fb_state *from, const recursion *r, double dt)
{
  static double sample[BLOCKS];
  for (int k = 0; k < BLOCKS; k++) {
    fb_state state = *from;
    fb_rk4_work work;
    recursion copy = *r;
    const double start = clock_ns();
    for (int i = 0; i < BLOCK; i++) {
      if (body) {
        (void)fb_rk4_step(body, &state, &work, NULL, NULL, NULL, (fb_real)dt);
      } else {
        recursion_step(&copy);
      }
    }
    sample[k] = clock_ns() - start + 1e-30 * (double)(state.q[0] + copy.x[0]);
  }
  return clock_timing_of(sample, BLOCKS).lowest;
}

void hard_decay(int brief)
{
  static hard_craft craft;
  static fb_body body;
  static recursion moving, decayed;
  const double zeta = 0.5, rest[3] = {0};
  const int steps = 20000;
  fb_real q_dot[FB_MAX_MODES] = {0};
  fb_state start, state;
  fb_rk4_work work;
  double dt;
  hard_row row = {.name = "decay",
                  .what = "a damped boom long after it came to rest",
                  .degree = "numbers a step carries",
                  .measure = "subnormal numbers in its state",
                  .bound = 0.5,
                  .naive = "the modes' linear recursion as it is"};
  hard_craft_init(&craft, BOOM_LENGTH, BOOM_LINE, BOOM_EI);
  craft.keep.count[FB_KIND_BEND_Y] = craft.keep.count[FB_KIND_BEND_Z] = MODES;
  craft.level.base = FB_BASE_PRESCRIBED;
  craft.level.effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING;
  for (int k = 0; k < 2 * MODES; k++) {
    craft.level.zeta[k] = (fb_real)zeta;
    q_dot[k] = FB_R(0.001);
  }
  hard_craft_build(&body, &craft);
  dt = 0.5 * (double)fb_rk4_limit(&body, 0, 0);
  hard_start(&body, &start, rest, rest, q_dot);
  recursion_init(&moving, body.n, zeta, dt);
  state = start;
  decayed = moving;
  for (int k = 0; k < steps; k++) {
    hard_must(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, (fb_real)dt), "step");
    recursion_step(&decayed);
  }
  row.hard = 2.0 * body.n;
  row.steps = steps;
  row.time = steps * dt;
  row.periods = row.time * HARD_FIRST / (2.0 * HARD_PI);
  row.figure = subnormals(state.q, body.n) + subnormals(state.pi, body.n);
  row.naive_figure = subnormals(decayed.x, 2 * body.n);
  hard_report(&row);
  if (!brief) {
    row.name = "decay cost";
    row.measure = "time of a step against that of the moving boom";
    row.bound = 1.2;
    row.figure = block_time(&body, &state, &decayed, dt) / block_time(&body, &start, &moving, dt);
    row.naive_figure = block_time(NULL, &state, &decayed, dt) / block_time(NULL, &start, &moving, dt);
    row.excused = row.naive_figure < row.bound; /* the processor takes subnormal numbers at full speed */
    hard_report(&row);
  }
}
