/* spin.c - spinning bodies: energy lost inside turns a spin about the minor axis flat; a spin far above the first bending
   frequency. */
#include "hard.h"

/* ---- flat spin: a whip antenna along the axis x of a satellite with moments of inertia C about x and A across, and
   damping in its modes (frequency omega, angular momentum H). At constant |h|, with theta the angle of x from h,
   n = h cos(theta)/C and the nutation nu = n C/A, seen in the body as nu - n:
     T = h^2/2 (sin^2/A + cos^2/C),  dT/dt = -sum of c (nu - n)^2 (nu H h sin(theta)/A)^2 / |omega^2 - nu^2 + i c (nu - n)|^2
   over the modes of one plane, c = 2 zeta omega. */

#define ZETA 0.3

typedef struct satellite {
  fb_body body;
  double A, C, h; /* [kg m^2], of the whole as it is undeformed; [N m s] */
} satellite;

/* theta_dot by the energy it costs; hard_shape has the modes, two alike, one for each plane. */
static double sink(const satellite *s, double theta)
{
  const double n = s->h * cos(theta) / s->C, nu = n * s->C / s->A, beat = nu - n;
  double power = 0.0;
  for (int k = 0; k < hard_shape.n; k += 2) {
    const double omega = sqrt((double)hard_shape.K[k * (hard_shape.n + 1)]), c = 2.0 * ZETA * omega;
    const double re = omega * omega - nu * nu, im = c * beat;
    const double force = nu * hard_length(hard_shape.H + 3 * k) * s->h * sin(theta) / s->A;
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

/* Runs from theta by rk4, or by explicit Euler, beside the energy sink: largest difference of the angle [rad]. */
static double nutation_apart(satellite *s, double theta, double dt, double steps, int euler, double *end)
{
  const double rest[3] = {0};
  const double w[3] = {s->h * cos(theta) / s->C, s->h * sin(theta) / s->A, 0};
  fb_state state;
  fb_rk4_work work;
  double apart = 0.0;
  int well = 1;
  hard_start(&s->body, &state, rest, w, NULL);
  for (double k = 0; k < steps && well; k++) {
    theta += dt * sink(s, theta + 0.5 * dt * sink(s, theta));
    well = euler ? hard_euler(&s->body, &state, NULL, dt)
                 : fb_rk4_step(&s->body, &state, &work, NULL, NULL, NULL, (fb_real)dt) == FB_OK;
    apart = fmax(apart, fabs(nutation(&state) - theta));
    hard_progress(k, steps);
  }
  *end = nutation(&state);
  return well ? apart : HUGE_VAL;
}

/* The row of a satellite (A, C) that spins at n; naive: fewer effects, or explicit Euler. */
static void satellite_report(hard_row *row, double A, double C, double n, double from, double steps, int euler)
{
  static satellite s;
  const double dt = 0.05; /* [s] */
  static char measure[96];
  double end, naive_end;
  s.h = C * n;
  satellite_build(&s, A, C, FB_EFFECTS_FULL);
  row->hard = C / A;
  row->steps = steps;
  row->time = steps * dt;
  row->periods = row->time * fabs(1.0 - C / A) * n / (2.0 * HARD_PI);
  row->bound = 0.05;
  row->figure = nutation_apart(&s, from, dt, steps, 0, &end);
  if (!euler) {
    satellite_build(&s, A, C, FB_EFFECTS_LINEAR);
  }
  row->naive_figure = nutation_apart(&s, from, dt, steps, euler, &naive_end);
  snprintf(measure, sizeof measure, "angle of the axis, from %.2g to %.2g rad, against the energy sink [rad]", from,
           end);
  row->measure = measure;
  hard_report(row);
}

void hard_flat_spin(int brief)
{
  const double steps = brief ? 2e5 : 2e6;
  hard_row minor = {.name = "flat-spin minor",
                    .what = "flexible satellite about its minor axis, damping in the antenna: it must go to flat spin",
                    .degree = "moments of inertia C/A",
                    .naive = "linear modes without gyroscopic coupling (FB_EFFECTS_LINEAR)"};
  hard_row major = {.name = "flat-spin major",
                    .what = "the same about its major axis: it must stay, the nutation die out",
                    .degree = "moments of inertia C/A",
                    .naive = "explicit Euler at the same step"};
  satellite_report(&minor, 8.0, 4.8, 1.5, brief ? 0.6 : 0.1, steps, 0);
  satellite_report(&major, 5.0, 8.0, 0.7, 0.4, steps, 1);
}
