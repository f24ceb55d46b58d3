/* spinup_model.h - the scene of spinup.c and table1.c: a flexible beam about z, by the rate of its hub or by a torque.
   Models: bending modes with the quadratic displacement, or axial coordinates with nonlinear strain ([DB] section 4),
   in any form of the equations of motion and any integrator. Define PROGRAM, the name in messages, and include it in
   one file. */
#ifndef SPINUP_MODEL_H
#define SPINUP_MODEL_H
#include "capacities.h"
#define FLEXBEAM_IMPLEMENTATION
#include "../../flexbeam.h"
#include "../common/boom.h"
#include "../common/options.h"
#include "../common/stepper.h"
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define PI 3.14159265358979323846
#define MAX_ROWS 200001

enum { DRIVE_HUB, DRIVE_TORQUE };
enum { AFTER_ZERO, AFTER_HOLD };
enum { BASIS_OPEN, BASIS_CLOSED };

typedef struct scene {
  double length, mass, ei, ea; /* [m], [kg], [N m^2], [N] */
  double ramp, t_end, dt;      /* [s] */
  int drive, after;            /* DRIVE_..., AFTER_... */
  double spin, torque;         /* [rad/s] final rate of the hub, [N m] amplitude of the torque */
  int modes;                   /* bending modes per plane, when elements is 0 */
  unsigned effects;            /* with modes */
  int elements, polynomial;    /* elements per direction and the degree of their functions */
  int basis, degree;           /* BASIS_..., highest degree Q of the terms kept */
  int planes;                  /* of bending: 1 or 2 */
  int form, torque_form;       /* FB_FORM_..., FB_TORQUE_... */
  int integrator;              /* row of integrators */
} scene;

static const scene default_scene = {.length = BOOM_LENGTH,
                                    .mass = BOOM_MASS,
                                    .ei = BOOM_EI,
                                    .ea = BOOM_EA,
                                    .ramp = 15,
                                    .t_end = 30,
                                    .spin = 6,
                                    .torque = 160,
                                    .modes = 3,
                                    .effects = FB_EFFECTS_FULL,
                                    .basis = BASIS_OPEN,
                                    .degree = 3,
                                    .polynomial = 3,
                                    .planes = 1};

/* ---- messages and numbers */

static int read_whole(int *n, const char *name, const char *text, int least, int most)
{
  char *end;
  const long value = strtol(text, &end, 10);
  if (end == text || *end || value < least || value > most) {
    char message[96];
    snprintf(message, sizeof message, "%s wants a whole number from %d to %d", name, least, most);
    return fail(message, text);
  }
  *n = (int)value;
  return 0;
}

/* ---- the integrators: one row each, in the order of fb_integrator */

typedef struct integrator {
  const char *name;
  double dt; /* [s] where none is asked for, unless the limit is shorter */
  fb_real (*limit)(const fb_body *body, fb_real spin, fb_real acceleration);
} integrator;

static const integrator integrators[] = {
    {"rk4", 0.001, fb_rk4_limit},
    {"midpoint", 0.005, fb_implicit_limit},
    {"sdirk", 0.005, fb_implicit_limit},
    {"exponential", 0.005, fb_exponential_limit},
};
#define INTEGRATORS ((int)(sizeof integrators / sizeof integrators[0]))

/* ---- the model */

static struct {
  fb_shape shape;
  fb_body_work body_work;
  fb_form_body formed;
  fb_form_work form_work;
  int tip;   /* node */
  int split; /* the library takes this body for half of something */
} model;

static fb_status build_shape(const scene *s)
{
  const boom b = {
      s->length, s->mass, s->ei, s->ea, s->planes, s->modes, s->elements, s->polynomial, s->basis == BASIS_OPEN};
  return boom_shape(&model.shape, &model.tip, &b);
}

static fb_status build(const scene *s)
{
  const fb_form_desc form = {(fb_form)s->form, (fb_stiffness_torque)s->torque_form, &boom_torque};
  fb_body_desc desc;
  fb_status status = build_shape(s);
  memset(&desc, 0, sizeof desc);
  desc.effects = s->elements ? FB_EFFECTS_STRAIN : s->effects;
  desc.base = s->drive == DRIVE_TORQUE ? FB_BASE_HINGED : FB_BASE_PRESCRIBED;
  desc.truncation = s->degree < 3 ? (fb_truncation)(FB_TRUNCATE_ABOVE_0 + s->degree) : FB_TRUNCATE_NONE;
  status = status ? status : fb_form_init(&model.formed, &model.body_work, &model.shape, &desc, &form);
  model.split = status == FB_ERR_EFFECTS;
  if (model.split) { /* to show what halves do; the programs say so */
    desc.allow_split_effects = 1;
    status = fb_form_init(&model.formed, &model.body_work, &model.shape, &desc, &form);
  }
  return status;
}

static int build_or_say(const scene *s)
{
  const fb_status status = build(s);
  if (status == FB_ERR_CAPACITY && s->elements) {
    return fail(
        "cannot build the model: fewer --elements, a lower --polynomial or one of --planes, it holds 40 coordinates "
        "and 60 strain stations",
        "");
  }
  return status == FB_OK ? 0 : fail("cannot build the model", fb_status_string(status));
}

/* The final rate [rad/s]; of a torque that of the rigid beam. */
static double final_spin(const scene *s)
{
  const double inertia = s->mass * s->length * s->length / 3;
  const double hold = s->after == AFTER_HOLD && s->t_end > s->ramp ? s->t_end - s->ramp : 0;
  return s->drive == DRIVE_HUB ? s->spin : s->torque * (s->ramp + hold) / inertia;
}

/* The longest step [s] of the integrator for the undeflected body at its final rate. */
static double step_limit(const scene *s)
{
  return (double)integrators[s->integrator].limit(&model.formed.body, (fb_real)final_spin(s), 0);
}

/* A step [s] with some room below the limit (slopes of the beam lower it where strain is nonlinear); a whole number of
   them makes a hundredth of a second, so that rows of all runs are at the same times. */
static double default_step(const scene *s)
{
  const double dt = fmin(integrators[s->integrator].dt, (s->elements ? 0.7 : 0.8) * step_limit(s));
  return 0.01 / ceil(0.01 / dt * (1 - 1e-9));
}

static long steps_of(const scene *s)
{
  return (long)ceil(s->t_end / s->dt * (1 - 1e-12));
}

/* Rows about every hundredth of a second, so that the reference's times are among them. */
static long stride_of(const scene *s)
{
  const long steps = steps_of(s);
  const double dt = s->t_end / (double)steps;
  long stride = (long)floor(0.01 / dt * (1 + 1e-9));
  const long most = steps / (MAX_ROWS - 2) + 1;
  stride = stride > most ? stride : most;
  while (stride > 1 && steps % stride) {
    stride--;
  }
  return stride > most ? stride : most;
}

/* ---- a run */

typedef struct history { /* one run */
  int rows;
  double t[MAX_ROWS], tip_x[MAX_ROWS], tip_y[MAX_ROWS], omega[MAX_ROWS], energy[MAX_ROWS], work[MAX_ROWS];
  fb_status status; /* of the step that ended it */
  double t_stop;    /* [s] reached */
  double ns;        /* [ns] per step, drive included */
} history;

/* The input at t of the step around middle, returns the rate of the torque. A held torque jumps at the end of the ramp:
   the jump lies between two steps, not in one. */
static double drive(fb_input *input, const scene *s, double t, double middle)
{
  const double turn = 2 * PI / s->ramp;
  double g = 0, g_dot = 0;
  if (s->drive == DRIVE_HUB) {
    const int on = t < s->ramp;
    input->w[2] = (fb_real)(on ? s->spin / s->ramp * (t - sin(turn * t) / turn) : s->spin);
    input->w_dot[2] = (fb_real)(on ? s->spin / s->ramp * (1 - cos(turn * t)) : 0.0);
    return 0;
  }
  if (middle < s->ramp) {
    g = s->torque * (1 - cos(turn * t));
    g_dot = s->torque * turn * sin(turn * t);
  } else if (s->after == AFTER_HOLD) {
    g = s->torque;
  }
  input->n_load = 1; /* at node 0, the hinge */
  input->load[0].torque[2] = (fb_real)g;
  return g_dot;
}

typedef struct power {
  double p, p_dot; /* [W], [W/s] of the torque */
} power;

static power power_of(const fb_state *state, const fb_input *input, double g_dot)
{
  const double g = (double)input->load[0].torque[2];
  power out = {0, 0};
  fb_motion motion;
  if (input->n_load > 0 && fb_form_motion_eval(&model.formed, &motion, state, input) == FB_OK) {
    out.p = g * (double)motion.w[2];
    out.p_dot = g_dot * (double)motion.w[2] + g * (double)motion.w_dot[2];
  }
  return out;
}

static void record(history *h, const fb_state *state, const fb_input *input, double t, double work)
{
  fb_motion motion;
  fb_node_motion node;
  fb_energy energy;
  if (fb_form_motion_eval(&model.formed, &motion, state, input) == FB_OK &&
      fb_body_node_motion_eval(&model.formed.body, &node, state, &motion, model.tip) == FB_OK &&
      fb_form_energy_eval(&model.formed, &energy, state, input) == FB_OK) {
    h->t[h->rows] = t;
    h->tip_x[h->rows] = (double)node.displacement[0];
    h->tip_y[h->rows] = (double)node.displacement[1];
    h->omega[h->rows] = (double)motion.w[2];
    h->work[h->rows] = work;
    h->energy[h->rows++] = (double)(energy.kinetic + energy.strain);
  }
}

/* Runs the model; stride 0 only times it. The work is the trapezoid rule with its end correction, of order 4. */
static void run(history *h, const scene *s, long stride)
{
  const long steps = steps_of(s);
  const double dt = s->t_end / (double)steps;
  static fb_stepper by;
  static fb_exponential exponential;
  double sum = 0, g_dot;
  long k;
  fb_state state;
  fb_input input[3];
  power start, end;
  clock_t begin;
  (void)fb_state_init(&model.formed.body, &state);
  h->status = s->form == FB_FORM_MOMENTUM ? body_stepper(&by, &exponential, &model.body_work, &model.formed.body,
                                                         &state, input, (fb_integrator)s->integrator, dt)
                                          : FB_OK;
  if (h->status != FB_OK) {
    h->rows = 0;
    h->t_stop = 0;
    return;
  }
  begin = clock();
  memset(input, 0, sizeof input);
  (void)drive(&input[0], s, 0, 0);
  h->status = FB_OK;
  h->t_stop = s->t_end;
  end = power_of(&state, &input[0], 0);
  if (stride) {
    h->rows = 0;
    record(h, &state, &input[0], 0, 0);
  }
  for (k = 0; k < steps; k++) {
    const double t = (double)k * dt, middle = t + 0.5 * dt;
    start = end;
    if (s->drive == DRIVE_TORQUE && middle >= s->ramp && middle - dt < s->ramp) {
      g_dot = drive(&input[0], s, t, middle); /* the other side of a jump */
      start = power_of(&state, &input[0], g_dot);
    }
    (void)drive(&input[1], s, middle, middle);
    g_dot = drive(&input[2], s, t + dt, middle);
    h->status = s->form == FB_FORM_MOMENTUM
                    ? fb_stepper_step(&by)
                    : fb_form_step(&model.formed, &state, &model.form_work, (fb_integrator)s->integrator, &input[0],
                                   &input[1], &input[2], (fb_real)dt, 0);
    if (h->status != FB_OK) {
      h->t_stop = t;
      break;
    }
    input[0] = input[2];
    if (stride) {
      end = power_of(&state, &input[0], g_dot);
      sum += 0.5 * dt * (start.p + end.p) + dt * dt / 12 * (start.p_dot - end.p_dot);
    }
    if (stride && (k + 1) % stride == 0) {
      record(h, &state, &input[0], t + dt, sum);
    }
  }
  if (!stride) {
    h->ns = 1e9 * (double)(clock() - begin) / CLOCKS_PER_SEC / (double)(k < steps ? k + 1 : steps);
  }
}

/* Recorded, then timed: the quietest of some runs (0: not timed). */
static void run_timed(history *h, const scene *s, int repeat)
{
  double least = HUGE_VAL;
  run(h, s, stride_of(s));
  for (int k = 0; k < repeat; k++) {
    run(h, s, 0);
    least = fmin(least, h->ns);
  }
  h->ns = least;
}

/* How many times faster than the motion. */
static double real_time_factor(const history *h, const scene *s)
{
  return 1e9 * s->t_end / (double)steps_of(s) / h->ns;
}

/* ---- results */

typedef struct series {
  int rows;
  double t[MAX_ROWS], y[MAX_ROWS];
} series;

static int read_reference(series *s, const char *path)
{
  static char line[16384];
  int t_column = -1, y_column = -1;
  FILE *file = fopen(path, "r");
  s->rows = 0;
  if (!file) {
    return fail("cannot read the reference", path);
  }
  while (fgets(line, sizeof line, file) && s->rows < MAX_ROWS) {
    const int header = t_column < 0;
    int column = 0;
    if (line[0] == '#') {
      continue;
    }
    for (char *p = strtok(line, ",\r\n"); p; p = strtok(NULL, ",\r\n"), column++) {
      if (header) {
        t_column = strcmp(p, "t") == 0 ? column : t_column;
        y_column = strcmp(p, "GE_u2") == 0 ? column : y_column;
      } else if (column == t_column) {
        s->t[s->rows] = strtod(p, NULL);
      } else if (column == y_column) {
        s->y[s->rows] = strtod(p, NULL);
      }
    }
    s->rows += !header;
    if (header && (t_column < 0 || y_column < 0)) {
      break;
    }
  }
  fclose(file);
  return s->rows > 1 ? 0 : fail("the reference has no columns t and GE_u2", path);
}

/* A column of a run at time t; linear between rows. */
static double value_at(const history *h, const double *column, double t)
{
  const double x = t / h->t[h->rows - 1] * (h->rows - 1);
  int k = (int)x;
  k = k < 0 ? 0 : k > h->rows - 2 ? h->rows - 2 : k;
  return column[k] + (t - h->t[k]) / (h->t[k + 1] - h->t[k]) * (column[k + 1] - column[k]);
}

/* Largest difference of the tip deflection up to the end of both, relative to the reference's peak. */
static double tip_error(const history *h, const series *reference)
{
  double error = 0.0, peak = 0.0;
  for (int k = 0; k < reference->rows; k++) {
    peak = fmax(peak, fabs(reference->y[k]));
    if (reference->t[k] <= h->t[h->rows - 1] * (1 + 1e-12) && h->rows > 1) {
      error = fmax(error, fabs(value_at(h, h->tip_y, reference->t[k]) - reference->y[k]));
    }
  }
  return peak > 0 ? error / peak : 0.0;
}

/* The largest deflection [m] and its time [s], by a parabola through three rows. */
static double tip_peak(const history *h, double *t)
{
  int k = 0;
  double y = 0, slope, bend, x;
  for (int i = 0; i < h->rows; i++) {
    k = fabs(h->tip_y[i]) > fabs(h->tip_y[k]) ? i : k;
  }
  *t = h->t[k];
  y = h->tip_y[k];
  if (k == 0 || k + 1 >= h->rows) {
    return y;
  }
  slope = 0.5 * (h->tip_y[k + 1] - h->tip_y[k - 1]);
  bend = h->tip_y[k + 1] - 2 * y + h->tip_y[k - 1];
  x = bend == 0.0 ? 0.0 : -slope / bend; /* [rows] */
  *t += x * (h->t[k] - h->t[k - 1]);
  return y + 0.5 * slope * x;
}

/* Largest difference of energy and work, relative to the peak energy. */
static double energy_error(const history *h)
{
  double error = 0, peak = 0;
  for (int k = 0; k < h->rows; k++) {
    error = fmax(error, fabs(h->energy[k] - h->work[k]));
    peak = fmax(peak, fabs(h->energy[k]));
  }
  return peak > 0 ? error / peak : 0;
}
#endif
