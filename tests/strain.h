/* strain.h - a beam with nonlinear axial strain, its spin-up; scenes shared by test_body_strain.c and test_forms.c.
   Basis C is closed under rotation (the same functions in every direction), H has strain at the root as well. */
#ifndef FBT_STRAIN_H
#define FBT_STRAIN_H

/* >>body and >>assemble: nonlinear axial strain and the equations of D'Eleuterio and Barfoot [DB] beside the momentum
   form, on their spin-up of a beam. Basis C is closed under rotation (the same functions in every direction), H has
   strain at the root as well. */
#include "fbt.h"

#define LENGTH 10.0
#define MASS 12.0
#define BENDING 14004.0    /* [N m^2] EI */
#define STRETCH 31724000.0 /* [N] EA */
#define RAMP 15.0          /* [s] of torque or of growing rate */

typedef struct scene {
  int n_element, degree, root_strain, planes;
  int natural; /* modes instead of functions */
} scene;

static double kilogram = 1.0; /* what bodies are measured in */
static double outer = 1.0;    /* what the section at the tip has of that at the root */
static const scene closed_3d = {2, 3, 0, 2, 0}, open_3d = {2, 3, 1, 2, 0};
static fb_beam_desc beam_desc;
static fb_beam beam;
static fb_modes modes;
static fb_modes_work modes_work;
static fb_shape shape;
static fb_body_desc desc;
static fb_form_torque torque_of; /* of the shape */
static fb_form_body formed;
static fb_body body; /* of it: in the momentum form it moves alike */
static fb_body_work body_work;

static inline void scene_modes(const scene *s, double EI_y)
{
  static fb_modes_desc keep;
  memset(&beam_desc, 0, sizeof beam_desc);
  beam_desc.length = (fb_real)LENGTH;
  beam_desc.n_element = s->n_element;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = (fb_real)(MASS / LENGTH * kilogram);
  beam_desc.station[0].EA = (fb_real)(STRETCH * kilogram);
  beam_desc.station[0].EI_y = (fb_real)(EI_y * kilogram);
  beam_desc.station[0].EI_z = (fb_real)(BENDING * kilogram);
  if (outer < 1.0) {
    fb_section *const tip = &beam_desc.station[beam_desc.n_station++];
    tip->x = (fb_real)LENGTH;
    tip->mass = (fb_real)outer * beam_desc.station[0].mass;
    tip->EA = (fb_real)outer * beam_desc.station[0].EA;
    tip->EI_y = (fb_real)outer * beam_desc.station[0].EI_y;
    tip->EI_z = (fb_real)outer * beam_desc.station[0].EI_z;
  }
  memset(&keep, 0, sizeof keep);
  keep.basis = s->natural ? FB_BASIS_MODES : FB_BASIS_FUNCTIONS;
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_AXIAL] = s->natural ? 3 : FB_ALL_MODES;
  keep.count[FB_KIND_BEND_Z] = s->planes == 2 ? keep.count[FB_KIND_BEND_Y] : 0;
  keep.degree = s->natural ? 0 : s->degree;
  keep.root_strain = s->root_strain;
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
}

/* The beam on a rigid hub (or none), its tip as node 1. */
static inline void scene_shape(const scene *s, double EI_y, int hub)
{
  static const fb_real center[3] = {FB_R(0.3), -FB_R(0.2), FB_R(0.1)};
  static const double J[6] = {40.0, 30.0, 50.0, 2.0, -1.0, 3.0};
  fb_real inertia[6];
  int tip;
  for (int i = 0; i < 6; i++) {
    inertia[i] = (fb_real)(J[i] * kilogram);
  }
  scene_modes(s, EI_y);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_strain(&shape, 0, &beam, &modes), FB_OK);
  memset(&torque_of, 0, sizeof torque_of);
  FBT_INT_EQ(fb_form_torque_add_beam(&torque_of, &shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &tip, 0, &beam, &modes, (fb_real)LENGTH), FB_OK);
  if (hub) {
    FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)(20.0 * kilogram), center, inertia), FB_OK);
  }
}

static inline void scene_body(int form, int torque, fb_base base, unsigned effects)
{
  const fb_form_desc kind = {(fb_form)form, (fb_stiffness_torque)torque, &torque_of};
  desc.base = base;
  desc.effects = effects;
  memset(&body_work, 0xff, sizeof body_work); /* what is in it means nothing */
  FBT_INT_EQ(fb_form_init(&formed, &body_work, &shape, &desc, &kind), FB_OK);
  body = formed.body;
  FBT_INT_EQ(fb_form_check(&formed), FB_OK);
}

static inline void desc_clear(void)
{
  memset(&desc, 0, sizeof desc);
  desc.deflection_limit = FB_R(5.0);
}

/* Random deflection: bending of about half a meter, stretch of some millimeters. */
static inline void bend(fb_real *q)
{
  for (int a = 0; a < modes.n; a++) {
    q[a] = (fb_real)((modes.kind[a] == FB_KIND_AXIAL ? 0.004 : 0.4) * sqrt(kilogram) * fbt_random());
  }
}

/* A bent body in motion; the velocities do not depend on the form. */
static inline void moving_state(fb_state *state)
{
  fb_real v[3], w[3], q_dot[FB_MAX_MODES];
  fbt_seed(7);
  FBT_INT_EQ(fb_state_init(&body, state), FB_OK);
  fbt_fill(state->quat, 4, 1.0);
  FBT_INT_EQ(fb_quat_normalize(state->quat), FB_OK);
  bend(state->q);
  bend(q_dot);
  fbt_fill(v, 3, 1.0);
  fbt_fill(w, 3, 1.0);
  FBT_INT_EQ(fb_form_state_from_velocity(&formed, state, v, w, q_dot), FB_OK);
}

/* Loads at O in body axes. */
static inline void loads_at_O(fb_input *input)
{
  memset(input, 0, sizeof *input);
  input->n_load = 1;
  input->load[0].axes = FB_AXES_BODY;
  fbt_fill(input->load[0].force, 3, 20.0);
  fbt_fill(input->load[0].torque, 3, 50.0);
}

/* ---- the forms, one evaluation */

static inline void accelerations(fb_real *acc, fb_state *state, const fb_input *input)
{
  fb_motion motion;
  moving_state(state);
  FBT_INT_EQ(fb_form_motion_eval(&formed, &motion, state, input), FB_OK);
  memcpy(acc, fbt_v_dot(&motion), 3 * sizeof *acc);
  memcpy(acc + 3, motion.w_dot, sizeof motion.w_dot);
  for (int a = 0; a < modes.n; a++) {
    acc[6 + a] = motion.q_ddot[a] / (fb_real)sqrt(kilogram);
  }
}

/* Largest difference of the accelerations of two forms, relative to the largest acceleration of each kind. */
static inline double acceleration_difference(const fb_real *a, const fb_real *b)
{
  const double rigid = fbt_difference(a, b, 6) / fbt_largest(b, 6);
  const double elastic = fbt_difference(a + 6, b + 6, modes.n) / fbt_largest(b + 6, modes.n);
  return fmax(rigid, elastic);
}

/* ---- the spin-up */

#define ROWS 61 /* every 0.5 s from 0 on */

typedef struct spin_up {
  scene beam;
  int form;
  int torque;
  fb_truncation cut;
  int prescribed; /* variant C: given rate; else A: hinged, torque for 15 s */
  int per_second; /* steps */
  double end;     /* [s] */
} spin_up;

typedef struct track {
  int rows;
  double u1[ROWS], u2[ROWS]; /* [m] tip */
  double lag;                /* [m] smallest u2 */
  fb_status status;
  double stop;                  /* [s] where it did not end well */
  double work, energy, balance; /* [J] of the torque, peak energy, largest difference; variant A */
} track;

/* Torque 160 (1 - cos) N m about z for 15 s, or the rate that it gives a rigid beam. */
static inline void spin_input(fb_input *input, int prescribed, double t)
{
  const double phase = 2.0 * 3.14159265358979323846 * t / RAMP, rise = t < RAMP ? 1.0 - cos(phase) : 0.0;
  if (prescribed) {
    input->w_dot[2] = (fb_real)(0.4 * rise);
    input->w[2] = (fb_real)(t < RAMP ? 6.0 / RAMP * (t - RAMP * sin(phase) / (2.0 * 3.14159265358979323846)) : 6.0);
  } else {
    input->n_load = 1;
    input->load[0].torque[2] = (fb_real)(160.0 * rise);
  }
}

static inline double tip(const fb_state *state, int axis)
{
  double u = 0.0;
  for (int a = 0; a < body.n; a++) {
    u += (double)(body.node[1].psi[3 * a + axis] * state->q[a]);
  }
  return u;
}

static inline void spin_body(const spin_up *s)
{
  scene_shape(&s->beam, BENDING, 0);
  desc_clear();
  desc.truncation = s->cut;
  desc.deflection_limit = (fb_real)(2.0 * LENGTH); /* as the references' */
  desc.allow_split_effects = s->cut != FB_TRUNCATE_NONE;
  desc.allow_long_step = 1;
  scene_body(s->form, s->torque, s->prescribed ? FB_BASE_PRESCRIBED : FB_BASE_HINGED, FB_EFFECTS_STRAIN);
}

/* Simpson's rule for the work, a step's share: c g w dt / 3; the energy where a pair of steps ends. */
static inline void account(track *out, const fb_state *state, const fb_input *input, int step, double dt)
{
  const double g = (double)input->load[0].torque[2];
  fb_motion motion;
  fb_energy e;
  FBT_INT_EQ(fb_form_motion_eval(&formed, &motion, state, input), FB_OK);
  out->work += (step % 2 ? 4.0 : 1.0) * g * (double)motion.w[2] * dt / 3.0;
  if (step % 2 == 0) {
    FBT_INT_EQ(fb_form_energy_eval(&formed, &e, state, NULL), FB_OK);
    out->energy = fmax(out->energy, (double)e.kinetic + (double)e.strain);
    out->balance = fmax(out->balance, fabs((double)e.kinetic + (double)e.strain - out->work));
    out->work += g * (double)motion.w[2] * dt / 3.0; /* begins the next pair */
  }
}

static inline void spin(track *out, const spin_up *s, int with_energy)
{
  static fb_input end[2], middle;
  static fb_form_work work;
  const int steps = (int)(s->end * s->per_second);
  const double dt = 1.0 / s->per_second;
  fb_state state;
  memset(out, 0, sizeof *out);
  memset(end, 0, sizeof end);
  memset(&middle, 0, sizeof middle);
  spin_body(s);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  out->rows = 1;
  for (int k = 0; k < steps; k++) {
    const fb_input *start = &end[k % 2], *next = &end[(k + 1) % 2];
    spin_input(&middle, s->prescribed, (k + 0.5) * dt);
    spin_input(&end[(k + 1) % 2], s->prescribed, (k + 1) * dt);
    out->status = fb_form_step(&formed, &state, &work, FB_INTEGRATOR_RK4, start, &middle, next, (fb_real)dt, 0);
    if (out->status != FB_OK) {
      out->stop = k * dt;
      FBT_INT_EQ(fb_state_check(&body, &state), FB_OK); /* is as before the step */
      return;
    }
    out->lag = fmin(out->lag, tip(&state, 1));
    if (2 * (k + 1) % s->per_second == 0) {
      out->u1[out->rows] = tip(&state, 0);
      out->u2[out->rows++] = tip(&state, 1);
    }
    if (with_energy) {
      account(out, &state, next, k + 1, dt);
    }
  }
}

/* Steps that the stiffest axial mode leaves stable. */
static inline int steps_per_second(int n_element)
{
  return FB_SINGLE ? 2000 : n_element == 1 ? 4000 : n_element == 2 ? 4000 : 6000;
}

#endif
