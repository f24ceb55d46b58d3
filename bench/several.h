/* several.h - bodies with several appendages that fly from rest: a hub, beams on it, one load. Run by the full set of
   effects with all modes as the reference, and by fewer of them: which modes are needed is found by leaving out, time
   and again, the one that by simulation is missed the least. */
#ifndef FBB_SEVERAL_H
#define FBB_SEVERAL_H

#include "ladder.h"

#define FBB_BEAMS 4

typedef struct fbb_several {
  const char *name;
  int n_beam;
  struct {
    double length, mass, EI_y, EI_z, turn; /* [m], [kg/m], [N m^2]; [rad] about z from x of the hub */
    int y, z;                              /* modes in its planes */
  } beam[FBB_BEAMS];
  double hub_mass, hub_inertia;       /* [kg], [kg m^2] */
  int at, output;                     /* nodes: 0 the hub, then the tips */
  double force[3], torque[3], period; /* sin of [N], [N m], body axes, for one period [s] */
  double duration;
} fbb_several;

#define FBB_BOOM(length, turn, y, z)  \
  {                                   \
    length, 0.5, 500, 500, turn, y, z \
  }
static const fbb_several fbb_several_cases[] = {
    {"two booms, torque about z",
     2,
     {FBB_BOOM(5, 0, 5, 5), FBB_BOOM(5, FBB_PI, 5, 5)},
     100,
     20,
     0,
     1,
     {0},
     {0, 0, 6},
     8,
     20},
    {"two booms, torque askew",
     2,
     {FBB_BOOM(5, 0, 4, 4), FBB_BOOM(5, FBB_PI, 4, 4)},
     100,
     20,
     0,
     2,
     {0},
     {2, 3, 6},
     4,
     15},
    {"two booms, push on the hub",
     2,
     {FBB_BOOM(5, 0, 4, 4), FBB_BOOM(5, FBB_PI, 4, 4)},
     20,
     20,
     0,
     1,
     {0, 6, 4},
     {0},
     3,
     15},
    {"two booms, push on the other's tip",
     2,
     {FBB_BOOM(5, 0, 4, 4), FBB_BOOM(5, FBB_PI, 4, 4)},
     20,
     5,
     2,
     1,
     {0, 1, 0},
     {0},
     3,
     15},
    {"two booms, push on a tip",
     2,
     {FBB_BOOM(5, 0, 4, 4), FBB_BOOM(5, FBB_PI, 4, 4)},
     100,
     20,
     1,
     1,
     {0, 0.5, 1},
     {0},
     2,
     15},
    {"unequal booms, torque about z",
     2,
     {FBB_BOOM(6, 0, 4, 4), FBB_BOOM(3.5, FBB_PI, 4, 4)},
     60,
     8,
     0,
     2,
     {0},
     {0, 0, 4},
     4,
     15},
    {"four booms, torque about z",
     4,
     {FBB_BOOM(5, 0, 3, 2), FBB_BOOM(5, 0.5 * FBB_PI, 3, 2), FBB_BOOM(5, FBB_PI, 3, 2),
      FBB_BOOM(5, 1.5 * FBB_PI, 3, 2)},
     100,
     20,
     0,
     1,
     {0},
     {0, 0, 10},
     6,
     15},
    {"four booms, torque about x",
     4,
     {FBB_BOOM(5, 0, 2, 3), FBB_BOOM(5, 0.5 * FBB_PI, 2, 3), FBB_BOOM(5, FBB_PI, 2, 3),
      FBB_BOOM(5, 1.5 * FBB_PI, 2, 3)},
     100,
     20,
     0,
     2,
     {0},
     {6, 0, 0},
     6,
     15},
    {"a boom and a panel, torque about z",
     2,
     {FBB_BOOM(6, 0, 5, 3), {4, 3, 400, 40000, 0.5 * FBB_PI, 5, 5}},
     150,
     30,
     0,
     1,
     {0},
     {0, 0, 6},
     6,
     15},
    {"a boom and a panel, torque about x",
     2,
     {FBB_BOOM(6, 0, 5, 5), {4, 3, 400, 40000, 0.5 * FBB_PI, 5, 5}},
     150,
     30,
     0,
     2,
     {0},
     {5, 0, 0},
     6,
     15},
};

/* All modes of the beams, one beam after the other; node k is the tip of beam k - 1. */
static void fbb_several_shape(fb_shape *shape, const fbb_several *c)
{
  static const fb_real center[3] = {0};
  static fb_beam_desc desc;
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work work;
  const fb_real J = (fb_real)c->hub_inertia, inertia[6] = {J, J, J, 0, 0, 0};
  int n = 0, first = 0, node;
  for (int k = 0; k < c->n_beam; k++) {
    n += c->beam[k].y + c->beam[k].z;
  }
  fbb_check(fb_shape_init(shape, n), c->name);
  fbb_check(fb_shape_add_rigid(shape, (fb_real)c->hub_mass, center, inertia), c->name);
  for (int k = 0; k < c->n_beam; k++) {
    fb_modes_desc keep;
    memset(&desc, 0, sizeof desc);
    memset(&keep, 0, sizeof keep);
    desc.length = (fb_real)c->beam[k].length;
    desc.attitude[0] = (fb_real)cos(0.5 * c->beam[k].turn);
    desc.attitude[3] = (fb_real)sin(0.5 * c->beam[k].turn);
    desc.n_element = 10;
    desc.n_station = 1;
    desc.station[0].mass = (fb_real)c->beam[k].mass;
    desc.station[0].EI_y = (fb_real)c->beam[k].EI_y;
    desc.station[0].EI_z = (fb_real)c->beam[k].EI_z;
    keep.count[FB_KIND_BEND_Y] = c->beam[k].y;
    keep.count[FB_KIND_BEND_Z] = c->beam[k].z;
    fbb_check(fb_beam_init(&beam, &desc), c->name);
    fbb_check(fb_modes_solve(&modes, &work, &beam, &keep), c->name);
    fbb_check(fb_shape_add_beam(shape, first, &beam, &modes), c->name);
    fbb_check(fb_shape_add_beam_node(shape, &node, first, &beam, &modes, desc.length), c->name);
    first += c->beam[k].y + c->beam[k].z;
  }
}

/* The load at time t. */
static void fbb_several_input(fb_input *input, const fbb_several *c, double t)
{
  const double s = t < c->period ? sin(2 * FBB_PI * t / c->period) : 0.0;
  memset(input, 0, sizeof *input);
  input->n_load = 1;
  input->load[0].node = c->at;
  input->load[0].axes = FB_AXES_BODY;
  for (int i = 0; i < 3; i++) {
    input->load[0].force[i] = (fb_real)(s * c->force[i]);
    input->load[0].torque[i] = (fb_real)(s * c->torque[i]);
  }
}

/* What happens at most, as an engineer would estimate it: the body turns about the hub as a rigid one, by the integral
   of the moment over half its period, and not at all after it. */
static void fbb_several_envelope(fb_envelope *e, const fbb_several *c)
{
  const fb_real hub = (fb_real)c->hub_inertia;
  fb_real J[9] = {hub, 0, 0, 0, hub, 0, 0, 0, hub}, x[3] = {0}, moment[3], scale[3];
  int perm[3];
  fb_input input;
  memset(e, 0, sizeof *e);
  fbb_several_input(&input, c, 0.25 * c->period);
  e->n_load = 1;
  e->load[0] = input.load[0];
  e->frequency = (fb_real)(2 * FBB_PI / c->period);
  e->duration = (fb_real)c->duration;
  e->lasts = (fb_real)c->period;
  e->frame = (fb_real)(c->duration / FBB_SAMPLES);
  e->node = c->output;
  for (int k = 0; k < c->n_beam; k++) {
    const double L = c->beam[k].length, mL2 = c->beam[k].mass * L * L * L / 3;
    const double along[3] = {cos(c->beam[k].turn), sin(c->beam[k].turn), 0};
    for (int i = 0; i < 9; i++) {
      J[i] += (fb_real)(mL2 * ((i % 4 == 0) - along[i / 3] * along[i % 3]));
    }
    for (int i = 0; i < 3 && c->at == k + 1; i++) {
      x[i] = (fb_real)(L * along[i]);
    }
  }
  fb_vec3_cross(moment, x, input.load[0].force);
  for (int i = 0; i < 3; i++) {
    moment[i] = (moment[i] + input.load[0].torque[i]) * (fb_real)(c->period / FBB_PI);
  }
  fbb_check(fb_lu_factor(J, perm, scale, 3), c->name);
  fb_lu_solve(e->spin, J, perm, moment, 3);
}

typedef struct fbb_several_trial { /* what the library's trials run */
  const fbb_several *c;
  const fb_shape *shape;
  double ns_per_s;
} fbb_several_trial;

static fb_status fbb_several_run(void *user, fb_real *output, const fb_advice *candidate)
{
  static fb_shape shape;
  static fb_body body;
  static fb_body_work work;
  static fb_exponential exponential;
  static fb_stepper stepper;
  fbb_several_trial *const trial = (fbb_several_trial *)user;
  const fbb_several *const c = trial->c;
  const int steps = (int)lround(c->duration / FBB_SAMPLES / (double)candidate->dt);
  const double dt = c->duration / FBB_SAMPLES / steps;
  double time = 0.0;
  fb_input input[3];
  fb_state state;
  fb_body_desc desc;
  fb_status status = fb_shape_select(&shape, trial->shape, candidate->coordinate, candidate->n);
  memset(&desc, 0, sizeof desc);
  desc.effects = candidate->effects;
  desc.allow_long_step = 1;
  status = status ? status : fb_body_init(&body, &work, &shape, &desc);
  status = status ? status : fb_state_init(&body, &state);
  status =
      status ? status : body_stepper(&stepper, &exponential, &work, &body, &state, input, candidate->integrator, dt);
  for (int k = 0; k < FBB_SAMPLES && status == FB_OK; k++) {
    const double start = clock_own_ns();
    fb_motion motion;
    fb_node_motion node;
    for (int i = 0; i < steps && status == FB_OK; i++) {
      for (int j = 0; j < 3; j++) {
        fbb_several_input(&input[j], c, (k * steps + i + 0.5 * j) * dt);
      }
      status = fb_stepper_step(&stepper);
    }
    time += clock_own_ns() - start;
    memset(&motion, 0, sizeof motion);
    status = status ? status : fb_body_node_motion_eval(&body, &node, &state, &motion, c->output);
    for (int i = 0; i < 3 && status == FB_OK; i++) {
      output[3 * k + i] = node.displacement[i];
    }
  }
  trial->ns_per_s = time / c->duration;
  return status;
}

#endif
