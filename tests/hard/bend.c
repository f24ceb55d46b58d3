/* bend.c - beams of large deflection: rolled up by several turns, let go on a light hub. */
#include "hard.h"

enum { MOMENT_MODE = 3 }; /* modes of a boom in one plane, one of them the static shape of a moment on the tip */

/* A boom that bends in its xy plane: natural modes and the static shape of a moment on its tip. */
static void flat_boom(hard_craft *craft, int modes, int points)
{
  hard_craft_init(craft, BOOM_LENGTH, BOOM_LINE, BOOM_EI);
  craft->keep.count[FB_KIND_BEND_Y] = modes - 1;
  craft->keep.n_load = 1;
  craft->keep.load[0].node = craft->beam.n_element;
  craft->keep.load[0].axis = 5;
  craft->keep.line_points = points;
  craft->level.effects = FB_EFFECTS_LARGE;
}

/* Coordinates of rest under a moment on the tip: its curvature is constant, K q = theta(tip) moment. */
static void roll_up(fb_state *state, const fb_body *body, double moment)
{
  for (int a = 0; a < body->n; a++) {
    state->q[a] = (fb_real)(moment * (double)hard_shape.node[HARD_TIP].theta[3 * a + 2] /
                            (double)hard_shape.K[a * (body->n + 1)]);
  }
}

/* Distance of the tip of a boom rolled up by `turns` from where the arc of a circle ends, of the length. */
static double arc_error(const hard_craft *craft, double turns)
{
  static fb_body body;
  const double angle = 2.0 * HARD_PI * turns, radius = BOOM_LENGTH / angle;
  const double end[2] = {radius * sin(angle) - BOOM_LENGTH, radius * (1.0 - cos(angle))};
  fb_state state;
  double tip[3];
  hard_craft_build(&body, craft);
  hard_must(fb_state_init(&body, &state), "state");
  roll_up(&state, &body, angle * BOOM_EI / BOOM_LENGTH);
  hard_tip(tip, &body, &state);
  return hypot(tip[0] - end[0], tip[1] - end[1]) / BOOM_LENGTH;
}

void hard_roll(int brief)
{
  static hard_craft craft;
  hard_row row;
  (void)brief;
  memset(&row, 0, sizeof row);
  row.name = "roll";
  row.what = "a boom rolled up by a moment on its tip, three modes, 30 points";
  row.degree = "turns";
  row.hard = 3.0;
  row.measure = "tip against the arc of a circle, of the length";
  row.bound = HARD_TOL(1e-6, 1e-3); /* single: rounding of the modes by 19 rad */
  row.naive = "the second-order displacement field (FB_EFFECTS_FULL)";
  flat_boom(&craft, MOMENT_MODE, 30);
  craft.level.base = FB_BASE_PRESCRIBED;
  row.figure = arc_error(&craft, row.hard);
  craft.level.effects = FB_EFFECTS_FULL;
  row.naive_figure = arc_error(&craft, row.hard);
  hard_report(&row);
}

/* A boom on a light hub, rolled up until its tip has turned by `angle`, is let go; largest change of energy, or of the
   angular momentum by what the hub's would be at one turn a second, relative. */
static double release_error(const hard_craft *craft, double angle, double steps, double dt, int euler)
{
  static fb_body body;
  static fb_rk4_work work;
  const double whole = 2.0 * HARD_PI * craft->hub_inertia[2];
  fb_state state;
  fb_momentum momentum;
  double energy, worst = 0.0;
  int well = 1;
  hard_craft_build(&body, craft);
  hard_must(fb_state_init(&body, &state), "state");
  roll_up(&state, &body, angle * BOOM_EI / BOOM_LENGTH);
  energy = hard_energy(&body, &state);
  for (double k = 0; k < steps && well; k++) {
    well = euler ? hard_euler(&body, &state, NULL, dt)
                 : fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, (fb_real)dt) == FB_OK;
    if (fmod(k, 64.0) < 0.5 && well) {
      well = fb_body_momentum_eval(&body, &momentum, &state, NULL) == FB_OK;
      worst = fmax(worst, fmax(fabs(hard_energy(&body, &state) / energy - 1.0), hard_length(momentum.angular) / whole));
    }
    hard_progress(k, steps);
  }
  return well ? worst : HUGE_VAL;
}

void hard_release(int brief)
{
  static hard_craft craft;
  hard_row row;
  memset(&row, 0, sizeof row);
  flat_boom(&craft, MOMENT_MODE, 0);
  craft.hub_mass = 5.0;
  craft.hub_inertia[0] = craft.hub_inertia[1] = craft.hub_inertia[2] = 20.0;
  row.name = "release";
  row.what = "a boom on a light hub let go from where its tip has turned past its root";
  row.degree = "rotation of the tip [degrees]";
  row.hard = 225.0;
  row.steps = brief ? 2e4 : 1e6;
  row.time = row.steps * 5e-4;
  row.periods = row.time * HARD_FIRST / (2.0 * HARD_PI);
  row.measure = "change of energy, or angular momentum by the hub's at one turn a second, relative";
  row.bound = HARD_TOL(brief ? 1e-5 : 1e-4, 1e-2);
  row.naive = "explicit Euler at the same step";
  row.figure = release_error(&craft, row.hard * HARD_PI / 180.0, row.steps, 5e-4, 0);
  row.naive_figure = release_error(&craft, row.hard * HARD_PI / 180.0, row.steps, 5e-4, 1);
  hard_report(&row);
}
