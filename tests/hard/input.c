/* input.c - numbers that are not what one expects: units of any size, input that makes no sense. */
#include "hard.h"

/* ---- units */

typedef struct units { /* how many of them are a kilogram, a meter, a second */
  double mass, length, time;
} units;

/* A boom tumbles and swings after a push, everything in those units. */
static void unit_body(fb_body *body, const units *u)
{
  static hard_craft craft;
  const double inertia = u->mass * u->length * u->length;
  hard_craft_init(&craft, BOOM_LENGTH * u->length, BOOM_LINE * u->mass / u->length,
                  BOOM_EI * inertia * u->length / (u->time * u->time));
  craft.beam.n_element = 4; /* best in single precision */
  craft.keep.count[FB_KIND_BEND_Y] = craft.keep.count[FB_KIND_BEND_Z] = 2;
  craft.hub_mass = 20.0 * u->mass;
  craft.hub_inertia[0] = 40.0 * inertia;
  craft.hub_inertia[1] = 30.0 * inertia;
  craft.hub_inertia[2] = 50.0 * inertia;
  hard_craft_build(body, &craft);
}

enum { SEEN = 7, STEPS = 2000 };

/* Its attitude and the tip's deflection [m] after the steps. */
static void unit_run(double seen[SEEN], const fb_body *body, const units *u)
{
  static const double zero[3] = {0};
  const double w[3] = {0.3 / u->time, 0.5 / u->time, -0.4 / u->time}, dt = 0.002 * u->time;
  fb_rk4_work work;
  fb_state state;
  fb_input input;
  memset(&input, 0, sizeof input);
  input.n_load = 1;
  input.load[0].node = HARD_TIP;
  hard_start(body, &state, zero, w, NULL);
  for (int k = 0; k < STEPS; k++) {
    input.load[0].force[1] = (fb_real)(k < 200 ? 20.0 * u->mass * u->length / (u->time * u->time) : 0.0);
    hard_must(fb_rk4_step(body, &state, &work, &input, &input, &input, (fb_real)dt), "step");
  }
  hard_tip(seen + 4, body, &state);
  for (int i = 0; i < 4; i++) {
    seen[i] = (double)state.quat[i];
  }
  for (int i = 4; i < SEEN; i++) {
    seen[i] /= u->length;
  }
}

/* What one would write: elimination that calls a pivot zero by its size. */
static int naive_is_singular(const fb_body *body)
{
  double A[6][6];
  for (int i = 0; i < 6; i++) {
    for (int j = 0; j < 6; j++) {
      A[i][j] = (double)body->S0[fb_sym6_index(i, j)];
    }
  }
  for (int k = 0; k < 6; k++) {
    if (fabs(A[k][k]) < HARD_TOL(1e-12, 1e-6)) {
      return 1;
    }
    for (int i = k + 1; i < 6; i++) {
      for (int j = 5; j >= k; j--) {
        A[i][j] -= A[i][k] / A[k][k] * A[k][j];
      }
    }
  }
  return 0;
}

void hard_units(int brief)
{
  /* single precision flushes below 1e-12 and refuses above 1e18 */
  const double big = HARD_TOL(1e30, 1e5), third = HARD_TOL(1e10, 30.0), half = HARD_TOL(1e15, 100.0);
  const units list[] = {{big, 1, 1},      {1 / big, 1, 1}, {1, third, 1},          {1, 1 / third, 1},      {1, 1, half},
                        {1, 1, 1 / half}, {big, 1, half},  {1 / big, 1, 1 / half}, {1 / big, 1 / third, 1}};
  const units si = {1, 1, 1};
  static fb_body body;
  double expected[SEEN], seen[SEEN];
  hard_row row = {
      .name = "units",
      .what = "a tumbling boom in units of mass, length, time in which stiffnesses are so many times larger or smaller",
      .degree = "factor",
      .measure = "attitude and deflection [m] against those in SI",
      .bound = HARD_TOL(1e-10, 1e-3),
      .naive = HARD_TOL("pivots below 1e-12 taken for zero, in one of the units at least",
                        "pivots below 1e-6 taken for zero, in one of the units at least")};
  (void)brief;
  unit_body(&body, &si);
  unit_run(expected, &body, &si);
  for (int k = 0; k < HARD_COUNT(list); k++) {
    unit_body(&body, &list[k]);
    unit_run(seen, &body, &list[k]);
    for (int i = 0; i < SEEN; i++) {
      row.figure = fmax(row.figure, fabs(seen[i] - expected[i]));
    }
    row.naive_figure = naive_is_singular(&body) ? HUGE_VAL : row.naive_figure;
  }
  row.hard = big;
  row.steps = STEPS * HARD_COUNT(list);
  hard_report(&row);
}

/* ---- absurd input */

static fb_body body;
static fb_exponential exponential;
static fb_system mechanism;
static fb_system_work system_work;
static fb_exact exact;
static fb_exact_work exact_work;

typedef struct subject { /* all that a step takes and changes */
  fb_state state;
  fb_system_state system;
  fb_exact_state exact;
  fb_input input;
  fb_system_input system_input;
  fb_exact_input exact_input;
  fb_real dt;
} subject;

enum { SYSTEM_RK4 = FB_INTEGRATOR_COUNT, SYSTEM_SDIRK, EXACT, STEPPERS }; /* those of a body before them */

static fb_status step(subject *s, int which)
{
  static fb_rk4_work rk4;
  static fb_implicit_work implicit;
  static fb_exponential_work scratch;
  const fb_input *in = &s->input;
  const fb_system_input *sin = &s->system_input;
  switch (which) {
  case FB_INTEGRATOR_RK4:
    return fb_rk4_step(&body, &s->state, &rk4, in, in, in, s->dt);
  case FB_INTEGRATOR_MIDPOINT:
    return fb_midpoint_step(&body, &s->state, &implicit, in, s->dt, 0);
  case FB_INTEGRATOR_SDIRK:
    return fb_sdirk_step(&body, &s->state, &implicit, in, in, s->dt, 0);
  case FB_INTEGRATOR_EXPONENTIAL:
    return fb_exponential_step(&body, &exponential, &s->state, &scratch, in, in, in);
  case SYSTEM_RK4:
    return fb_system_rk4_step(&mechanism, &body, &s->system, &system_work, sin, sin, sin, s->dt);
  case SYSTEM_SDIRK:
    return fb_system_sdirk_step(&mechanism, &body, &s->system, &system_work, sin, sin, s->dt, 0);
  case EXACT:
    return fb_exact_step(&exact, &s->exact, &exact_work, &s->exact_input, s->dt);
  default:
    return FB_OK; /* counts as accepted */
  }
}

static void subject_init(subject *s)
{
  static hard_craft craft;
  static fb_system_desc desc;
  static fb_exact_desc exact_desc;
  static fb_body_work work;
  hard_craft_init(&craft, 2.0, 0.5, 50.0);
  craft.keep.count[FB_KIND_BEND_Y] = craft.keep.count[FB_KIND_BEND_Z] = 2;
  craft.hub_mass = 3.0;
  craft.hub_inertia[0] = craft.hub_inertia[1] = craft.hub_inertia[2] = 2.0;
  hard_craft_build(&body, &craft);
  memset(s, 0, sizeof *s);
  s->dt = FB_R(0.001);
  hard_must(fb_state_init(&body, &s->state), "state");
  hard_must(fb_exponential_init(&exponential, &work, &body, s->dt), "exponential scheme");
  desc.n_body = 2;
  desc.joint[1].kind = FB_JOINT_REVOLUTE;
  desc.joint[1].parent_node = HARD_TIP;
  hard_must(fb_system_init(&mechanism, &system_work, &body, &desc, 1), "system");
  hard_must(fb_system_state_init(&mechanism, &body, &s->system, &system_work, NULL, NULL), "system's state");
  exact_desc.length = 1;
  exact_desc.n_element = 4;
  exact_desc.n_station = 1;
  hard_must(fb_exact_station_init(&exact_desc.station[0], &craft.beam.station[0]), "section");
  hard_must(fb_exact_init(&exact, &exact_desc), "exact beam");
  hard_must(fb_exact_state_init(&exact, &s->exact, &exact_work, NULL), "exact beam");
  s->input.n_load = s->system_input.n_load = s->exact_input.n_load = 1;
}

enum { NUMBERS = 5, PLACES = 9, COUNTS = 4 };

/* Puts x where it does not belong. */
static void spoil(subject *s, int place, fb_real x)
{
  fb_real *const numbers[PLACES][3] = {
      {&s->dt, &s->dt, &s->dt},
      {&s->input.load[0].force[1], &s->system_input.load[0].load.force[1], &s->exact_input.load[0].force[1]},
      {&s->input.load[0].torque[2], &s->system_input.load[0].load.torque[2], &s->exact_input.load[0].torque[2]},
      {&s->state.q[0], &s->system.link[0].q[0], &s->exact.strain[5]},
      {&s->state.pi[1], &s->system.link[1].pi[1], &s->exact.momentum[1]},
      {&s->state.quat[2], &s->system.link[0].quat[2], &s->exact.quat[6]},
      {&s->state.rho[0], &s->system.link[0].x[0], &s->exact.r[3]},
      {&s->state.u[1], &s->system.link[0].p[1], &s->exact.momentum[0]},
      {&s->state.L[2], &s->system.link[0].p[5], &s->exact.strain[3]}};
  for (int i = 0; i < 3; i++) {
    *numbers[place][i] = x;
  }
}

static void spoil_count(subject *s, int which)
{
  static const int count[] = {-1, 1000000};
  if (which < 2) {
    s->input.n_load = s->system_input.n_load = s->exact_input.n_load = count[which];
  } else {
    s->input.load[0].node = s->system_input.load[0].load.node = s->exact_input.load[0].node = count[which - 2];
  }
}

void hard_absurd(int brief)
{
  static subject good, bad, before;
  const fb_real number[NUMBERS] = {(fb_real)NAN, (fb_real)INFINITY, -(fb_real)INFINITY, (fb_real)HARD_TOL(1e300, 1e30),
                                   -(fb_real)HARD_TOL(1e300, 1e30)};
  int tried = 0, through = 0, spoiled = 0;
  hard_row row = {
      .name = "absurd",
      .what = "numbers that are none or far too large, in step, loads and state, counts and nodes that do not exist",
      .degree = "attempts on seven steppers",
      .measure = "accepted, or state changed",
      .bound = 0.5,
      .naive = "an oscillator by semi-implicit Euler, no check: states spoiled"};
  (void)brief;
  subject_init(&good);
  for (int k = 0; k < NUMBERS * PLACES + COUNTS; k++) {
    bad = good;
    if (k < NUMBERS * PLACES) {
      double x[4] = {0.0, 0.0, 0.0, 0.001}; /* force, displacement, speed, step */
      spoil(&bad, k / NUMBERS, number[k % NUMBERS]);
      x[(k / NUMBERS + 3) % 4] = (double)number[k % NUMBERS];
      x[2] += x[3] * (x[0] - x[1]);
      x[1] += x[3] * x[2];
      spoiled += !(fabs(x[1]) + fabs(x[2]) < (double)FB_HUGE);
    } else {
      spoil_count(&bad, k - NUMBERS * PLACES);
    }
    for (int which = 0; which < STEPPERS; which++) {
      before = bad;
      if (which == FB_INTEGRATOR_EXPONENTIAL && k / NUMBERS == 0) {
        continue; /* made for a step, it takes none */
      }
      tried++;
      if (step(&bad, which) == FB_OK || memcmp(&bad, &before, sizeof bad) != 0) {
        fprintf(stderr, "absurd: stepper %d, place %d, number %d\n", which, k / NUMBERS, k % NUMBERS);
        through++;
      }
    }
  }
  row.hard = tried;
  row.figure = through;
  row.naive_figure = spoiled;
  hard_report(&row);
}
