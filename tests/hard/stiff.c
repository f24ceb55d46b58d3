/* stiff.c - steps of a thousand times the explicit limit; many modes on a hub that is next to nothing. */
#include "hard.h"
#include "../../examples/common/stepper.h"

/* ---- long steps */

typedef struct outcome {
  double most, last; /* energy there was, and at the end, of the first */
  double dt;         /* [s] */
} outcome;

/* A boom with stiff axial coordinates on a base at rest, every coordinate struck. */
static outcome struck(fb_integrator integrator, int allow, double factor, int steps)
{
  static const double rest[3] = {0};
  static const fb_input nothing[3];
  static hard_craft craft;
  static fb_body_work work;
  static fb_body body;
  static fb_stepper by;
  static fb_exponential exponential;
  fb_real q_dot[FB_MAX_MODES];
  fb_state state;
  outcome out = {0.0, 0.0, 0.0};
  double energy;
  hard_craft_init(&craft, BOOM_LENGTH, BOOM_LINE, BOOM_EI);
  hard_craft_stretch(&craft, 3e7, 3);
  craft.level.allow_long_step = allow;
  hard_craft_build(&body, &craft);
  out.dt = factor * (double)fb_rk4_limit(&body, 0, 0);
  for (int a = 0; a < body.n; a++) {
    q_dot[a] = (fb_real)(1e-3 * cos(3.0 * a));
  }
  hard_start(&body, &state, rest, rest, q_dot);
  hard_must(body_stepper(&by, &exponential, &work, &body, &state, nothing, integrator, out.dt), "integrator");
  energy = hard_energy(&body, &state);
  for (int k = 0; k < steps; k++) {
    if (fb_stepper_step(&by) != FB_OK) {
      out.most = out.last = HUGE_VAL;
      return out;
    }
    out.last = hard_energy(&body, &state) / energy;
    out.most = fmax(out.most, out.last);
  }
  return out;
}

void hard_long_steps(int brief)
{
  const double factor = 1000.0;
  const int steps = 20000;
  const outcome sdirk = struck(FB_INTEGRATOR_SDIRK, 0, factor, steps);
  const outcome midpoint = struck(FB_INTEGRATOR_MIDPOINT, 0, factor, steps);
  const outcome rk4 = struck(FB_INTEGRATOR_RK4, 1, factor, steps);
  hard_row row = {.name = "long-steps SDIRK2",
                  .what = "a boom with stiff axial coordinates, every one struck, L-stable integrator",
                  .degree = "step / limit of rk4",
                  .measure = "energy at the end, of the first",
                  .bound = HARD_TOL(1e-6, 1e-3),
                  .naive = "rk4 at the same step (allow_long_step)"};
  (void)brief;
  row.hard = factor;
  row.steps = steps;
  row.time = steps * sdirk.dt;
  row.periods = row.time * HARD_FIRST / (2.0 * HARD_PI);
  row.figure = sdirk.last;
  row.naive_figure = rk4.last;
  hard_report(&row);
  row.name = "long-steps midpoint";
  row.what = "the same by the implicit midpoint rule, which damps nothing";
  row.measure = "largest energy there was, of the first";
  row.bound = 2.0;
  row.figure = midpoint.most;
  row.naive_figure = rk4.most;
  hard_report(&row);
}

/* ---- many modes on a light hub */

enum { IN_A_PLANE = HARD_TOL(20, 6), ELEMENTS = HARD_TOL(14, 5), SAMPLES = 40 };

static const double length = BOOM_LENGTH, line = BOOM_LINE, stiffness = BOOM_EI; /* [m], [kg/m], [N m^2] */

static void light_hub_init(hard_craft *craft, double part)
{
  hard_craft_init(craft, length, line, stiffness);
  craft->beam.n_element = ELEMENTS;
  craft->beam.station[0].i_y = craft->beam.station[0].i_z = FB_R(0.02); /* [kg m] */
  craft->keep.count[FB_KIND_BEND_Y] = craft->keep.count[FB_KIND_BEND_Z] = IN_A_PLANE;
  craft->hub_mass = part * line * length;
  for (int i = 0; i < 3; i++) {
    craft->hub_inertia[i] = part * line * length * length * length / 3.0;
  }
}

/* Condition of S_0, lengths in those of the beam. */
static double condition(const fb_body *body)
{
  fb_real S[36], d[6], V[36];
  for (int i = 0; i < 6; i++) {
    for (int j = 0; j < 6; j++) {
      const double scale = (i > 2 ? length : 1.0) * (j > 2 ? length : 1.0);
      S[6 * i + j] = (fb_real)((double)body->S0[fb_sym6_index(i, j)] / scale);
    }
  }
  hard_must(fb_eig_sym_solve(d, V, S, 6), "condition");
  return (double)d[5] / (double)d[0];
}

#define PUSH 2.0 /* [N] */

/* A short push on the tip, inertial axes. */
static void push(fb_input *input, double t)
{
  memset(input, 0, sizeof *input);
  input->n_load = 1;
  input->load[0].node = HARD_TIP;
  if (t < 0.2) {
    input->load[0].force[1] = (fb_real)(PUSH * sin(HARD_PI * t / 0.2));
    input->load[0].force[2] = (fb_real)(0.5 * PUSH * sin(HARD_PI * t / 0.2));
  }
}

static void tip_position(double x[3], const fb_body *body, const fb_state *state)
{
  static fb_motion rest; /* positions want no velocities */
  fb_node_motion tip;
  hard_must(fb_body_node_motion_eval(body, &tip, state, &rest, HARD_TIP), "tip");
  for (int i = 0; i < 3; i++) {
    x[i] = (double)tip.position[i];
  }
}

/* Free flight after the push by the implicit midpoint rule: where the tip is. */
static void fly(double tip[SAMPLES][3], const fb_body *body, double dt, int steps)
{
  static fb_implicit_work work;
  fb_state state;
  fb_input input;
  hard_must(fb_state_init(body, &state), "state");
  for (int k = 0; k < SAMPLES * steps; k++) {
    push(&input, (k + 0.5) * dt);
    hard_must(fb_midpoint_step(body, &state, &work, &input, (fb_real)dt, 4), "step");
    if ((k + 1) % steps == 0) {
      tip_position(tip[k / steps], body, &state);
    }
    hard_progress(k, SAMPLES * steps);
  }
}

/* What one would write: the hub moved by the reaction of the beam's last step, the beam by the motion of the hub. */
static double staggered_apart(double tip[SAMPLES][3], const hard_craft *whole, double dt, int steps)
{
  static hard_craft craft;
  static fb_body beam;
  static fb_implicit_work work;
  double apart = 0.0, x[3];
  fb_state state;
  fb_input input;
  fb_motion motion;
  fb_real v[3] = {0}, w[3] = {0}, v_dot[3] = {0}, w_dot[3] = {0}, turn[3];
  craft = *whole;
  craft.hub_mass = 0.0;
  craft.level.base = FB_BASE_PRESCRIBED;
  hard_craft_build(&beam, &craft);
  hard_must(fb_state_init(&beam, &state), "state");
  for (int k = 0; k < SAMPLES * steps; k++) {
    push(&input, (k + 0.5) * dt);
    for (int i = 0; i < 3; i++) {
      input.v_dot[i] = v_dot[i];
      input.w_dot[i] = w_dot[i];
      input.v[i] = v[i] + (fb_real)(0.5 * dt) * v_dot[i];
      input.w[i] = w[i] + (fb_real)(0.5 * dt) * w_dot[i];
    }
    if (fb_midpoint_step(&beam, &state, &work, &input, (fb_real)dt, 4) != FB_OK ||
        fb_body_motion_eval(&beam, &motion, &state, &input) != FB_OK) {
      return HUGE_VAL;
    }
    fb_vec3_cross(turn, w, v);
    for (int i = 0; i < 3; i++) {
      v[i] += (fb_real)dt * v_dot[i];
      w[i] += (fb_real)dt * w_dot[i];
      v_dot[i] = -motion.reaction_force[i] / (fb_real)whole->hub_mass - turn[i];
      w_dot[i] = -motion.reaction_torque[i] / (fb_real)whole->hub_inertia[i];
    }
    if ((k + 1) % steps == 0) {
      tip_position(x, &beam, &state);
      for (int i = 0; i < 3; i++) {
        apart = fmax(apart, fabs(x[i] - tip[k / steps][i]));
      }
    }
  }
  return apart;
}

void hard_many_modes(int brief)
{
  static double tip[SAMPLES][3], ours[SAMPLES][3];
  static hard_craft craft, loose;
  static fb_body body;
  const double part = HARD_TOL(1e-6, 1e-3), dt = 0.001;
  const int steps = brief ? 20 : 200;
  double moved = 0.0;
  hard_row row = {
      .name = "many-modes",
      .what = HARD_TOL("forty modes on a hub of a millionth of their mass, thrown about by a push on the tip",
                       "twelve modes on a hub of a thousandth of their mass, thrown about by a push on the tip"),
      .degree = "condition of S_0",
      .measure = "tip against the free beam's own modes, of its way",
      .bound = HARD_TOL(1e-4, 1e-2),
      .naive = "hub and beam in turn, by the reaction of the last step"};
  light_hub_init(&loose, part);
  loose.beam.root = FB_ROOT_FREE;
  loose.beam.n_lump = 1;
  loose.beam.lump[0].mass = (fb_real)loose.hub_mass;
  for (int i = 0; i < 3; i++) {
    loose.beam.lump[0].inertia[i] = (fb_real)loose.hub_inertia[i];
  }
  loose.hub_mass = 0.0;
  hard_craft_build(&body, &loose);
  fly(tip, &body, dt, steps);
  light_hub_init(&craft, part);
  hard_craft_build(&body, &craft);
  row.hard = condition(&body);
  row.steps = SAMPLES * steps;
  row.time = row.steps * dt;
  row.periods = row.time * 22.3733 * sqrt(stiffness / (line * pow(length, 4.0))) / (2.0 * HARD_PI);
  fly(ours, &body, dt, steps);
  for (int k = 0; k < SAMPLES; k++) {
    for (int i = 0; i < 3; i++) {
      row.figure = fmax(row.figure, fabs(ours[k][i] - tip[k][i]));
      moved = fmax(moved, fabs(tip[k][i] - (i == 0 ? length : 0.0)));
    }
  }
  row.figure /= moved;
  row.naive_figure = staggered_apart(tip, &craft, dt, steps) / moved;
  hard_report(&row);
}
