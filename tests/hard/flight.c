/* flight.c - bodies that fly fast, and bodies that are thin: what rounding and truncation make of large momenta. */
#include "hard.h"

/* ---- flight speed */

static const double flight[3] = {18000.0, -19200.0, 14400.0}; /* [m/s] 30 km/s */

/* x += s (dc/dq)^T v: what a velocity v (body axes) of the frame adds to elastic momenta. */
static void carry(fb_real *x, double s, const fb_body *body, const fb_real *q, const fb_real v[3])
{
  const int constant = body->n_linear_constant, later = body->n_lambda_constant;
  for (int k = 0; k < constant + body->n_linear; k++) {
    const fb_lambda_term *const t = &body->lambda[k < constant ? k : later + k - constant];
    x[t->b] -= (fb_real)(s * (double)t->c * (t->a > 0 ? (double)q[t->a - 1] : 1.0) * (double)v[t->i]);
  }
}

/* Rates of a state whose elastic momenta are against inertial space. */
static int total_rates(fb_state *rate, const fb_body *body, const fb_state *total, const fb_input *input)
{
  fb_state at = *total;
  fb_motion motion;
  const fb_real still[FB_MAX_MODES] = {0};
  fb_real R[9], v[3], turn[3], faster[3];
  fb_quat_to_mat33(R, at.quat);
  fb_mat33_mulT_vec3(v, R, at.u);
  carry(at.pi, -1.0, body, at.q, v);
  if (fb_body_rates_eval(body, rate, &at, input) != FB_OK || fb_body_motion_eval(body, &motion, &at, input) != FB_OK) {
    return 0;
  }
  fb_vec3_cross(turn, v, motion.w);
  carry(rate->pi, 1.0, body, at.q, turn);
  fb_mat33_mulT_vec3(faster, R, rate->u);
  carry(rate->pi, 1.0, body, at.q, faster);
  carry(rate->pi, 1.0, body, motion.q_dot, v); /* d/dt of dc/dq: its linear part alone */
  carry(rate->pi, -1.0, body, still, v);
  return 1;
}

/* The classical integrator by the same equations with total momenta. */
static int total_step(const fb_body *body, fb_state *state, const fb_input *input, double dt)
{
  static const double part[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
  const fb_state from = *state;
  fb_state rate = from;
  for (int stage = 0; stage < 4; stage++) {
    fb_state at = from;
    hard_advance(&at, part[stage] * dt, &rate, body->n);
    if (!total_rates(&rate, body, &at, input)) {
      return 0;
    }
    hard_advance(state, weight[stage] * dt, &rate, body->n);
  }
  return 1;
}

/* Elastic displacement of the tip after some steps at a multiple of the flight's velocity. */
static void fly(double tip[3], const fb_body *body, double part, int steps, double dt, int total)
{
  static const double w[3] = {0.02, 0.03, 0.3};
  const double v[3] = {part * flight[0], part * flight[1], part * flight[2]};
  fb_real q_dot[FB_MAX_MODES], R[9], back[3];
  fb_input push;
  fb_state state;
  fb_rk4_work work;
  int sound = 1;
  for (int a = 0; a < body->n; a++) {
    q_dot[a] = (fb_real)(0.2 * cos(3.0 * a));
  }
  memset(&push, 0, sizeof push);
  push.n_load = 1;
  push.load[0].node = HARD_TIP;
  push.load[0].force[1] = FB_R(1.0);
  hard_start(body, &state, v, w, q_dot);
  if (total) {
    fb_quat_to_mat33(R, state.quat);
    fb_mat33_mulT_vec3(back, R, state.u);
    carry(state.pi, 1.0, body, state.q, back);
  }
  for (int k = 0; k < steps && sound; k++) {
    sound = total ? total_step(body, &state, &push, dt)
                  : fb_rk4_step(body, &state, &work, &push, &push, &push, (fb_real)dt) == FB_OK;
  }
  hard_tip(tip, body, &state);
  tip[0] = sound ? tip[0] : HUGE_VAL;
}

/* Of the largest displacement, by which one differs from that at rest. */
static double apart(const double tip[3], const double rest[3])
{
  double most = 0.0, size = 0.0;
  for (int i = 0; i < 3; i++) {
    most = fmax(most, fabs(tip[i] - rest[i]));
    size = fmax(size, fabs(rest[i]));
  }
  return most / size;
}

void hard_flight(int brief)
{
  static hard_craft craft;
  static fb_body body;
  const int steps = brief ? 100 : 1000;
  hard_row row = {.name = "flight",
                  .what = "a boom on a hub tumbles and bends at 30 km/s",
                  .degree = "speed / speed of the tip's bending",
                  .measure = "tip against the one at rest, of its displacement",
                  .bound = HARD_TOL(1e-9, 2e-5),
                  .naive = "classical Runge-Kutta, elastic momenta against inertial space"};
  double rest[3], tip[3], dt;
  hard_craft_init(&craft, BOOM_LENGTH, BOOM_LINE, BOOM_EI);
  craft.keep.count[FB_KIND_BEND_Y] = craft.keep.count[FB_KIND_BEND_Z] = 2;
  craft.hub_mass = 40.0;
  craft.hub_inertia[0] = craft.hub_inertia[1] = craft.hub_inertia[2] = 100.0;
  hard_craft_build(&body, &craft);
  dt = 0.5 * (double)fb_rk4_limit(&body, FB_R(0.31), 0);
  fly(rest, &body, 0.0, steps, dt, 0);
  fly(tip, &body, 1.0, steps, dt, 0);
  row.figure = apart(tip, rest);
  fly(tip, &body, 1.0, steps, dt, 1);
  row.naive_figure = apart(tip, rest);
  row.hard = 30000.0 / (0.2 * 2.0);
  row.steps = steps;
  row.time = steps * dt;
  row.periods = row.time * HARD_FIRST / (2.0 * HARD_PI);
  hard_report(&row);
}

/* ---- thin bodies */

void hard_slender(int brief)
{
  static fb_body body;
  static fb_body_work work;
  static const double rest[3] = {0};
  const double ratio = HARD_TOL(1e-8, 1e-4), dt = 0.85, across = 25.0 / 3.0;
  const int steps = brief ? 2000 : 200000;
  const fb_real center[3] = {0}, turn[3] = {0, FB_R(0.2), FB_R(0.2)};
  const fb_real inertia[6] = {(fb_real)(ratio * across), (fb_real)across, (fb_real)across};
  fb_body_desc desc;
  fb_state state, plain;
  fb_rk4_work scratch;
  double energy;
  int sound = 1, plain_sound = 1;
  hard_row row = {.name = "slender",
                  .what = "a tube without load turns across its axis",
                  .degree = "inertia about the axis / across",
                  .measure = "change of the energy, of the first",
                  .bound = HARD_TOL(1e-9, 1e-5),
                  .naive = "classical Runge-Kutta with the inertial angular momentum alone"};
  memset(&desc, 0, sizeof desc);
  hard_must(fb_shape_init(&hard_shape, 0), "tube");
  hard_must(fb_shape_add_rigid(&hard_shape, FB_R(1.0), center, inertia), "tube");
  hard_must(fb_body_init(&body, &work, &hard_shape, &desc), "tube");
  hard_start(&body, &state, rest, rest, NULL);
  for (int i = 0; i < 4; i++) {
    state.quat[i] = (fb_real)(0.5 + 0.1 * i);
  }
  hard_must(fb_quat_normalize(state.quat), "attitude");
  hard_must(fb_state_from_velocity(&body, &state, center, turn, NULL), "state");
  energy = hard_energy(&body, &state);
  plain = state;
  for (int k = 0; k < steps && sound; k++) {
    sound = fb_rk4_step(&body, &state, &scratch, NULL, NULL, NULL, (fb_real)dt) == FB_OK;
    plain_sound = plain_sound && hard_rk4(&body, &plain, dt);
    hard_progress(k, steps);
  }
  row.figure = sound ? fabs(hard_energy(&body, &state) / energy - 1.0) : HUGE_VAL;
  row.naive_figure = plain_sound ? fabs(hard_energy(&body, &plain) / energy - 1.0) : HUGE_VAL;
  row.hard = ratio;
  row.steps = steps;
  row.time = steps * dt;
  hard_report(&row);
}
