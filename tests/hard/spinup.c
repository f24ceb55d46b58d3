/* spinup.c - booms whose base spins up: to ten times the first bending frequency; very stiff along their axis. */
#include "hard.h"
#include "../../examples/common/stepper.h"

#define SAMPLES 100

typedef struct spinup {
  double length, mass, EI, EA; /* [m], [kg/m], [N m^2], [N] */
  double spin, ramp, duration; /* [rad/s] reached after ramp [s] */
  double tip[SAMPLES];         /* [m] of the exact beam, across the boom */
} spinup;

static void base_at(const spinup *s, double t, double *angle, double *w, double *w_dot)
{
  const double turn = 2.0 * HARD_PI / s->ramp, a = s->spin / s->ramp, u = t < s->ramp ? t : s->ramp;
  *angle = a * (0.5 * u * u + (cos(turn * u) - 1.0) / (turn * turn)) + s->spin * (t - u);
  *w = a * (u - sin(turn * u) / turn);
  *w_dot = a * (1.0 - cos(turn * u));
}

/* Fills s->tip. */
static void exact_run(spinup *s, double EA, int elements, double dt)
{
  static fb_exact_desc desc;
  static fb_exact exact;
  static fb_exact_state state;
  static fb_exact_work work;
  static fb_exact_input input;
  static fb_exact_node node[FB_MAX_EXACT + 1];
  const int steps = (int)(s->duration / (SAMPLES * dt) + 0.5);
  const fb_section section = {
      .mass = (fb_real)s->mass, .EI_y = (fb_real)s->EI, .EI_z = (fb_real)s->EI, .EA = (fb_real)EA};
  double angle, w, w_dot;
  memset(&desc, 0, sizeof desc);
  desc.length = (fb_real)s->length;
  desc.n_element = elements;
  desc.n_station = 1;
  hard_must(fb_exact_station_init(&desc.station[0], &section), "section");
  hard_must(fb_exact_init(&exact, &desc), "exact beam");
  hard_must(fb_exact_state_init(&exact, &state, &work, NULL), "exact beam");
  for (int k = 0; k < SAMPLES * steps; k++) {
    base_at(s, (k + 0.5) * dt, &angle, &w, &w_dot);
    input.w[2] = (fb_real)w;
    hard_must(fb_exact_step(&exact, &state, &work, &input, (fb_real)dt), "exact beam");
    if ((k + 1) % steps == 0) {
      hard_must(fb_exact_nodes_eval(&exact, node, &state), "exact beam");
      s->tip[k / steps] = (double)node[elements].displacement[1];
    }
    hard_progress(k, SAMPLES * steps);
  }
}

static double peak(const spinup *s)
{
  double most = 0.0;
  for (int k = 0; k < SAMPLES; k++) {
    most = fmax(most, fabs(s->tip[k]));
  }
  return most;
}

/* A modal body beside s->tip: largest difference by the largest deflection. */
static double modal_apart(const spinup *s, const fb_body *body, fb_integrator integrator, double dt)
{
  static fb_body_work work;
  static fb_stepper by;
  static fb_exponential exponential;
  fb_state state;
  fb_input input[3];
  const int steps = (int)(s->duration / (SAMPLES * dt) + 0.5);
  double apart = 0.0, u[3], angle, w, w_dot;
  memset(input, 0, sizeof input);
  hard_must(fb_state_init(body, &state), "state");
  hard_must(body_stepper(&by, &exponential, &work, body, &state, input, integrator, dt), "integrator");
  for (int k = 0; k < SAMPLES * steps; k++) {
    for (int i = 0; i < 3; i++) {
      base_at(s, (k + 0.5 * i) * dt, &angle, &w, &w_dot);
      input[i].w[2] = (fb_real)w;
      input[i].w_dot[2] = (fb_real)w_dot;
    }
    if (fb_stepper_step(&by) != FB_OK) {
      return HUGE_VAL;
    }
    if ((k + 1) % steps == 0) {
      hard_tip(u, body, &state);
      apart = fmax(apart, fabs(u[1] - s->tip[k / steps]));
    }
    hard_progress(k, SAMPLES * steps);
  }
  return apart / peak(s);
}

/* ---- far above the first bending frequency */

/* The bound: 2e-3 for the modes that are left out, and what rounds. That is the load per length across the boom:
   between the centrifugal one, m w^2 x, and that of the spin-up, m w_dot x, eps w^2 / w_dot of the latter; in single
   precision 7e-4 at the spin reached and the mean of w_dot. */
void hard_fast_spin(int brief)
{
  static spinup s = {.length = BOOM_LENGTH, .mass = BOOM_LINE, .EI = BOOM_EI};
  static hard_craft craft;
  static fb_body body;
  const double first = 3.51602 * sqrt(s.EI / (s.mass * pow(s.length, 4.0))), dt = 0.002;
  hard_row row = {.name = "fast-spin",
                  .what = "spin-up to far above the first bending frequency of a cantilever boom",
                  .degree = "spin / first bending frequency",
                  .measure = "tip against the exact beam, of the peak",
                  .naive = "premature linearization: inertia of the bent shape, no stiffening (allow_split_effects)"};
  row.hard = 10.0;
  s.spin = row.hard * first;
  s.ramp = brief ? 60.0 : 150.0;
  s.duration = s.ramp + 10.0;
  row.bound = 2e-3 + HARD_EPSILON * s.spin * s.ramp; /* w^2 / (w / ramp) */
  exact_run(&s, 0.0, 30, 0.01);
  hard_craft_init(&craft, s.length, s.mass, s.EI);
  craft.keep.count[FB_KIND_BEND_Y] = 6;
  craft.keep.spin = (fb_real)s.spin;
  craft.level.base = FB_BASE_PRESCRIBED;
  hard_craft_build(&body, &craft);
  row.figure = modal_apart(&s, &body, FB_INTEGRATOR_RK4, dt);
  row.time = s.duration;
  row.steps = s.duration / dt;
  row.periods = s.duration * first / (2.0 * HARD_PI);
  craft.level.effects = FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA;
  craft.level.allow_split_effects = 1;
  hard_craft_build(&body, &craft);
  row.naive_figure = modal_apart(&s, &body, FB_INTEGRATOR_RK4, dt);
  hard_report(&row);
}

/* ---- stiff along the axis */

/* What one would write: n point masses, springs of EA/h between neighbors, EI/h^3 on second differences; explicit. */
static double chain_apart(const spinup *s, int n, double dt)
{
  enum { MOST = 64 };
  static double x[MOST][2], v[MOST][2];
  const double h = s->length / n, m = s->mass * h, axial = s->EA / h, bend = s->EI / (h * h * h);
  const int steps = (int)(s->duration / (SAMPLES * dt) + 0.5);
  double apart = 0.0, angle, w, w_dot;
  for (int i = 0; i < n + 2; i++) { /* 0 and 1 are held: root and slope */
    x[i][0] = (i - 1) * h;
    x[i][1] = v[i][0] = v[i][1] = 0.0;
  }
  for (int k = 0; k < SAMPLES * steps; k++) {
    double f[MOST][2] = {{0}};
    base_at(s, (k + 1) * dt, &angle, &w, &w_dot);
    x[0][0] = -h * cos(angle);
    x[0][1] = -h * sin(angle);
    for (int i = 1; i < n + 1; i++) {
      const double length = hypot(x[i + 1][0] - x[i][0], x[i + 1][1] - x[i][1]);
      for (int j = 0; j < 2; j++) {
        const double pull = axial * (length - h) * (x[i + 1][j] - x[i][j]) / length;
        const double moment = bend * (x[i - 1][j] - 2.0 * x[i][j] + x[i + 1][j]);
        f[i][j] += pull + 2.0 * moment;
        f[i - 1][j] -= moment;
        f[i + 1][j] -= pull + moment;
      }
    }
    for (int i = 2; i < n + 2; i++) {
      for (int j = 0; j < 2; j++) {
        v[i][j] += dt * f[i][j] / (i == n + 1 ? 0.5 * m : m);
        x[i][j] += dt * v[i][j];
      }
    }
    if ((k + 1) % steps == 0) {
      const double across = cos(angle) * x[n + 1][1] - sin(angle) * x[n + 1][0];
      apart = fmax(apart, isfinite(across) ? fabs(across - s->tip[k / steps]) : HUGE_VAL);
    }
  }
  return apart / peak(s);
}

/* Bounds. Modal body: 1e-2 for the functions left out, and what rounds in the implicit integrator's solves: half an eps
   by the condition of 1 + (gamma dt)^2 K, gamma = 1 - sqrt(1/2), K to the highest frequency there is. Exact beam: 100
   times the inverse of the ratio, by which it does stretch, and what rounds in both runs: the load as in fast-spin, and
   positions once in each element. */
void hard_axial(int brief)
{
  static spinup s = {
      .length = BOOM_LENGTH, .mass = BOOM_LINE, .EI = BOOM_EI, .spin = 6.0, .ramp = 15.0, .duration = 20.0};
  static hard_craft craft;
  static fb_body body;
  static double rigid[SAMPLES];
  static const double ratio[] = {1e6, 1e8};
  const double dt = 0.005;
  hard_row row = {.name = "axial",
                  .what = "spin-up with axial coordinates, three elements of degree 5, SDIRK2 at 5 ms",
                  .degree = "EA L^2/EI",
                  .measure = "tip against the exact beam, of the peak",
                  .naive = "rk4 at the same step (allow_long_step)"};
  hard_row judge = {.name = "axial exact beam",
                    .what = "the same spin-up by the exact beam at 5 ms",
                    .degree = "EA L^2/EI",
                    .measure = "tip against the exact beam that cannot stretch, of the peak",
                    .naive = "point masses and springs, semi-implicit Euler at the same step"};
  (void)brief;
  row.steps = judge.steps = s.duration / dt;
  row.time = judge.time = s.duration;
  row.periods = judge.periods = s.duration * HARD_FIRST / (2.0 * HARD_PI);
  exact_run(&s, 0.0, 20, dt);
  memcpy(rigid, s.tip, sizeof rigid);
  for (int k = 0; k < HARD_COUNT(ratio); k++) {
    double apart = 0.0;
    row.hard = judge.hard = ratio[k];
    s.EA = ratio[k] * s.EI / (s.length * s.length);
    exact_run(&s, s.EA, 20, dt);
    for (int i = 0; i < SAMPLES; i++) {
      apart = fmax(apart, fabs(s.tip[i] - rigid[i]));
    }
    judge.figure = apart / peak(&s);
    judge.bound = 100.0 / ratio[k] + 2.0 * HARD_EPSILON * (s.spin * s.ramp + 20.0 * s.length / peak(&s));
    judge.naive_figure = chain_apart(&s, 20, dt);
    hard_craft_init(&craft, s.length, s.mass, s.EI);
    hard_craft_stretch(&craft, s.EA, 5);
    craft.level.allow_long_step = 1;
    hard_craft_build(&body, &craft);
    row.bound =
        1e-2 + 0.5 * HARD_EPSILON * pow((1.0 - sqrt(0.5)) * dt * 2.785 / (double)fb_rk4_limit(&body, 0, 0), 2.0);
    row.figure = modal_apart(&s, &body, FB_INTEGRATOR_SDIRK, dt);
    row.naive_figure = modal_apart(&s, &body, FB_INTEGRATOR_RK4, dt);
    hard_report(&row);
    hard_report(&judge);
  }
}
