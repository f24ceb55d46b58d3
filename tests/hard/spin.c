/* spin.c - spinning bodies: energy lost inside turns a spin about the minor axis flat; a spin far above the first
   bending frequency. */
#include "hard.h"

/* ---- flat spin: a whip antenna along the axis x of a satellite with moments of inertia C about x and A across, and
   damping in its modes (frequency omega, angular momentum H). At constant |h|, with theta the angle of x from h,
   n = h cos(theta)/C and the nutation nu = n C/A, seen in the body as nu - n:
     T = h^2/2 (sin^2/A + cos^2/C),  dT/dt = -sum of c (nu - n)^2 (nu H h sin(theta)/A)^2 / |omega^2 - nu^2 + i c (nu -
     n)|^2
   over the modes of one plane, c = 2 zeta omega. */

#define ZETA 0.3

typedef struct satellite {
  fb_body body;
  double A, C, h; /* [kg m^2], of the whole as it is undeformed; [N m s] */
} satellite;

/* theta_dot by the energy it costs; hard_shape has the modes, two alike, one for each plane. A spin about an axis
   across the antenna stiffens it by that part of its square, 0: as the argument leaves it out. */
static double sink(const satellite *s, double theta, double stiffening)
{
  const double across = s->h * sin(theta) / s->A;
  const double n = s->h * cos(theta) / s->C, nu = n * s->C / s->A, beat = nu - n;
  double power = 0.0;
  for (int k = 0; k < hard_shape.n; k += 2) {
    const double omega = sqrt((double)hard_shape.K[k * (hard_shape.n + 1)]), c = 2.0 * ZETA * omega;
    const double re = omega * omega + stiffening * across * across - nu * nu, im = c * beat;
    const double force = nu * hard_length(hard_shape.H + 3 * k) * across;
    power += c * beat * beat * force * force / (re * re + im * im);
  }
  return -power / (s->h * s->h * sin(theta) * cos(theta) * (1.0 / s->A - 1.0 / s->C));
}

/* Angle of the axis x from the angular momentum. */
static double nutation(const fb_state *state)
{
  fb_real R[9];
  double along = 0.0;
  fb_quat_to_mat33(R, state->quat);
  for (int i = 0; i < 3; i++) {
    along += (double)R[3 * i] * (double)state->L[i];
  }
  return acos(fmax(-1.0, fmin(1.0, along / hard_length(state->L))));
}

static void satellite_build(satellite *s, double A, double C, unsigned effects)
{
  static hard_craft craft;
  const double length = 3.0, line = 0.02;
  hard_craft_init(&craft, length, line, 1.6);
  craft.keep.count[FB_KIND_BEND_Y] = craft.keep.count[FB_KIND_BEND_Z] = 1;
  craft.hub_mass = 1e4; /* the mass center stays near O */
  craft.hub_inertia[0] = C;
  craft.hub_inertia[1] = craft.hub_inertia[2] = A - line * length * length * length / 3.0;
  craft.level.effects = effects | FB_EFFECT_DAMPING;
  craft.level.zeta[0] = craft.level.zeta[1] = (fb_real)ZETA;
  hard_craft_build(&s->body, &craft);
  s->A = A;
  s->C = C;
}

/* A run: largest difference of the angle from the energy sink's [rad], the angle at the end, when 45 degrees were
   passed (never: FB_HUGE) [s]. */
typedef struct nutating {
  double apart, end, half;
} nutating;

static double sink_step(const satellite *s, double theta, double dt, double stiffening)
{
  return theta + dt * sink(s, theta + 0.5 * dt * sink(s, theta, stiffening), stiffening);
}

/* From theta by rk4, or by explicit Euler, beside the energy sink. */
static nutating nutation_run(const satellite *s, double theta, double dt, double steps, int euler)
{
  const double rest[3] = {0};
  const double w[3] = {s->h * cos(theta) / s->C, s->h * sin(theta) / s->A, 0};
  fb_state state;
  fb_rk4_work work;
  nutating run = {0.0, 0.0, (double)FB_HUGE};
  int well = 1;
  hard_start(&s->body, &state, rest, w, NULL);
  for (double k = 0; k < steps && well; k++) {
    theta = sink_step(s, theta, dt, 0.0);
    well = euler ? hard_euler(&s->body, &state, NULL, dt)
                 : fb_rk4_step(&s->body, &state, &work, NULL, NULL, NULL, (fb_real)dt) == FB_OK;
    run.end = nutation(&state);
    run.half = run.end > 0.25 * HARD_PI ? fmin(run.half, (k + 1) * dt) : run.half;
    run.apart = fmax(run.apart, fabs(run.end - theta));
    hard_progress(k, steps);
  }
  run.apart = well ? run.apart : HUGE_VAL;
  return run;
}

/* When the energy sink passes 45 degrees [s]. */
static double sink_half(const satellite *s, double theta, double dt, double stiffening)
{
  double t = 0.0;
  for (; theta < 0.25 * HARD_PI; t += dt) {
    theta = sink_step(s, theta, dt, stiffening);
  }
  return t;
}

/* The row of a satellite (A, C) that spins at n; naive: fewer effects, or explicit Euler. */
static void satellite_report(hard_row *row, satellite *s, double n, double from, double steps, int euler,
                             nutating run[2])
{
  const double A = s->A, C = s->C, dt = 0.05; /* [s] */
  static char measure[96];
  s->h = C * n;
  satellite_build(s, A, C, FB_EFFECTS_FULL);
  row->hard = C / A;
  row->steps = steps;
  row->time = steps * dt;
  row->periods = row->time * fabs(1.0 - C / A) * n / (2.0 * HARD_PI);
  row->bound = 0.05;
  run[0] = nutation_run(s, from, dt, steps, 0);
  if (!euler) {
    satellite_build(s, A, C, FB_EFFECTS_LINEAR);
  }
  run[1] = nutation_run(s, from, dt, steps, euler);
  row->figure = run[0].apart;
  row->naive_figure = run[1].apart;
  snprintf(measure, sizeof measure, "angle of the axis, from %.2g to %.2g rad, against the energy sink [rad]", from,
           run[0].end);
  row->measure = measure;
  hard_report(row);
}

/* The part by which A is not what it is undeformed: the antenna deflected by the nutation has momentum of its own. */
static double give(const satellite *s)
{
  const double nu = s->h / s->A, omega = sqrt((double)hard_shape.K[0]), H = hard_length(hard_shape.H);
  return H * H * nu * nu / (s->A * (omega * omega - nu * nu));
}

/* The time to 45 degrees, bounded by what the argument leaves out: the spin across the antenna stiffens it where it
   bends, in the plane of the two, by 1.193 of its square (Southwell's coefficient of the first mode of a cantilever);
   and A, which is in the square of the force twice, in that of the beat and in dT/d theta with a factor C/(A - C). */
static void half_report(hard_row *row, const satellite *s, double from, const nutating run[2])
{
  const double dt = 0.05, half = sink_half(s, from, dt, 0.0);
  row->name = "flat-spin time";
  row->measure = "time to 45 degrees against the energy sink's, of it";
  row->bound = sink_half(s, from, dt, 1.193) / half - 1.0 + (4.0 + 3.0 * s->C / (s->A - s->C)) * give(s);
  row->figure = fabs(run[0].half / half - 1.0);
  row->naive_figure = fabs(run[1].half / half - 1.0);
  hard_report(row);
}

void hard_flat_spin(int brief)
{
  const double steps = brief ? 2e5 : 2e6, from = brief ? 0.6 : 0.1;
  satellite slender = {.A = 8.0, .C = 4.8}, flat = {.A = 5.0, .C = 8.0};
  nutating run[2];
  hard_row minor = {.name = "flat-spin minor",
                    .what = "flexible satellite about its minor axis, damping in the antenna: it must go to flat spin",
                    .degree = "moments of inertia C/A",
                    .naive = "linear modes without gyroscopic coupling (FB_EFFECTS_LINEAR)"};
  hard_row major = {.name = "flat-spin major",
                    .what = "the same about its major axis: it must stay, the nutation die out",
                    .degree = "moments of inertia C/A",
                    .naive = "explicit Euler at the same step"};
  satellite_report(&minor, &slender, 1.5, from, steps, 0, run);
  half_report(&minor, &slender, from, run);
  satellite_report(&major, &flat, 0.7, 0.4, steps, 1, run);
}
