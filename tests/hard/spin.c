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
static double sink(const satellite *s, double theta, double zeta)
{
  const double n = s->h * cos(theta) / s->C, nu = n * s->C / s->A, beat = nu - n;
  double power = 0.0;
  for (int k = 0; k < hard_shape.n; k += 2) {
    const double omega = sqrt((double)hard_shape.K[k * (hard_shape.n + 1)]), c = 2.0 * zeta * omega;
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

static void satellite_build(satellite *s, double A, double C, unsigned effects, double zeta)
{
  static hard_craft craft;
  const double length = 3.0, line = 0.02;
  hard_craft_init(&craft, length, line, 1.6);
  craft.keep.count[FB_KIND_BEND_Y] = craft.keep.count[FB_KIND_BEND_Z] = 1;
  craft.hub_mass = 1e4; /* the mass center stays near O */
  craft.hub_inertia[0] = C;
  craft.hub_inertia[1] = craft.hub_inertia[2] = A - line * length * length * length / 3.0;
  craft.level.effects = effects | FB_EFFECT_DAMPING;
  craft.level.zeta[0] = craft.level.zeta[1] = (fb_real)zeta;
  hard_craft_build(&s->body, &craft);
  s->A = A;
  s->C = C;
}

/* Runs from theta by rk4, or by explicit Euler, beside the energy sink: largest difference of the angle [rad]. */
static double nutation_apart(satellite *s, double theta, double zeta, double dt, double steps, int euler, double *end)
{
  const double rest[3] = {0};
  const double w[3] = {s->h * cos(theta) / s->C, s->h * sin(theta) / s->A, 0};
  fb_state state;
  fb_rk4_work work;
  double apart = 0.0;
  int well = 1;
  hard_start(&s->body, &state, rest, w, NULL);
  for (double k = 0; k < steps && well; k++) {
    const double half = theta + 0.5 * dt * sink(s, theta, zeta);
    theta += dt * sink(s, half, zeta);
    well = euler ? hard_euler(&s->body, &state, NULL, dt)
                 : fb_rk4_step(&s->body, &state, &work, NULL, NULL, NULL, (fb_real)dt) == FB_OK;
    apart = fmax(apart, fabs(nutation(&state) - theta));
    hard_progress(k, steps);
  }
  *end = nutation(&state);
  return well ? apart : HUGE_VAL;
}

void hard_flat_spin(int brief)
{
  static satellite s;
  const double zeta = ZETA, dt = 0.05, steps = brief ? 2e5 : 2e6;
  double end;
  hard_row minor = {.name = "flat-spin minor",
                    .what = "flexible satellite about its minor axis, damping in the antenna: it must go to flat spin",
                    .degree = "moments of inertia C/A",
                    .measure = "angle of the axis against the energy sink [rad]",
                    .bound = 0.05,
                    .naive = "linear modes without gyroscopic coupling (FB_EFFECTS_LINEAR)"};
  hard_row major = {.name = "flat-spin major",
                    .what = "the same about its major axis: it must stay, the nutation die out",
                    .degree = "moments of inertia C/A",
                    .measure = "angle of the axis against the energy sink [rad]",
                    .bound = 0.05,
                    .naive = "explicit Euler at the same step"};
  minor.hard = 4.8 / 8.0;
  minor.steps = major.steps = steps;
  minor.time = major.time = steps * dt;
  s.h = 4.8 * 1.5;
  minor.periods = steps * dt * (1.0 - minor.hard) * s.h / 4.8 / (2.0 * HARD_PI);
  satellite_build(&s, 8.0, 4.8, FB_EFFECTS_FULL, zeta);
  minor.figure = nutation_apart(&s, brief ? 0.6 : 0.1, zeta, dt, steps, 0, &end);
  satellite_build(&s, 8.0, 4.8, FB_EFFECTS_LINEAR, zeta);
  minor.naive_figure = nutation_apart(&s, brief ? 0.6 : 0.1, zeta, dt, steps, 0, &end);
  hard_report(&minor);
  s.h = 8.0 * 0.7;
  major.hard = 8.0 / 5.0;
  major.periods = steps * dt * (major.hard - 1.0) * s.h / 8.0 / (2.0 * HARD_PI);
  satellite_build(&s, 5.0, 8.0, FB_EFFECTS_FULL, zeta);
  major.figure = nutation_apart(&s, 0.4, zeta, dt, steps, 0, &end);
  major.naive_figure = nutation_apart(&s, 0.4, zeta, dt, steps, 1, &end);
  hard_report(&major);
}
