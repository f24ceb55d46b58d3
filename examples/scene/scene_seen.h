/* scene_seen.h - which modes the outputs of a scene see, and how much of them: the step that is chosen resolves each
   output, and an output that a step does not resolve is told. See scene.h.

   About the start d/dt x = f + A x + B u. An eigenvalue lambda of A with the residue R of (s - A)^-1 there answers to
   what is there at the start, and to a jump of an input u, in the output y = c x by

     2 |c R f / lambda|,   2 |c R b u / lambda|

   An input that bends, but does not jump, leaves F/|lambda| of that, and a smooth one the square, where its own
   frequency F is below |lambda|. R b is e (lambda + e - A)^-1 b for a small e: equal eigenvalues count together. */
#ifndef SCENE_SEEN_H
#define SCENE_SEEN_H
#include "scene_linear.h"
#include <complex.h>

#define SEEN_CAUSES (96 + SCENE_COMMANDS)
#define SEEN_INPUTS (96 + 3 * SCENE_ACTS)
#define SEEN_ROWS (3 * SCENE_OUTPUTS)

typedef struct seen_cause { /* column of B, and what of it acts; the first one is f, then one for each command */
  double size, frequency;   /* the most of the input; [rad/s], HUGE_VAL: it jumps */
  int smooth, command;      /* command: which one is the size, 0: none, else its number from 1 */
  fb_real b[FB_MAX_LINEAR];
} seen_cause;

typedef struct seen_input { /* a port: of a cause with a function, or of an act */
  fb_port port;
  int cause, act; /* act: -1, or what the commands of its allocation do with it */
  double weight;
} seen_input;

typedef struct seen_row { /* row of C; the output is `factor` of it times |lambda|^power */
  fb_port port;
  int output, is_port, power;
  double factor;
  double c[FB_MAX_LINEAR];
} seen_row;

static struct scene_sight {
  int n_cause, n_input, n_row, known; /* known: the amounts are there */
  seen_cause cause[SEEN_CAUSES];
  seen_input input[SEEN_INPUTS];
  seen_row row[SEEN_ROWS];
  int judged[SCENE_OUTPUTS]; /* the output has rows */
  /* of a mode in an output, without controllers, and by a command of 1 of each */
  double amount[1 + SCENE_COMMANDS][SCENE_OUTPUTS][FB_MAX_LINEAR];
  double complex M[FB_MAX_LINEAR * FB_MAX_LINEAR], x[SEEN_CAUSES][FB_MAX_LINEAR];
} sight;

/* ---- what moves the scene */

/* The most of a function in the run. */
static double seen_most(const scene *s, const function *f)
{
  double most = 0;
  for (int k = 0; k <= 256 + timing.n; k++) {
    const double t = k <= 256 ? s->duration * k / 256 : timing.instant[k - 257];
    most = fmax(most, fabs(function_eval(f, &s->tables, t, t + timing.slack).value));
  }
  return most;
}

static void seen_add_input(fb_port port, double weight, int cause, int act)
{
  if (sight.n_input < SEEN_INPUTS) {
    sight.input[sight.n_input++] = (seen_input){port, cause, act, weight};
  }
}

/* One more cause, of a function. */
static void seen_add_cause(const scene *s, fb_port port, double weight, const function *f)
{
  seen_cause *const c = &sight.cause[sight.n_cause];
  const double size = fabs(weight) * seen_most(s, f);
  if (sight.n_cause == SEEN_CAUSES || !(size > 0) || f->kind == FUNCTION_CONSTANT) {
    return; /* what is constant acts at the start */
  }
  c->size = size;
  c->frequency = function_frequency(f, &s->tables);
  c->smooth = f->kind == FUNCTION_SMOOTH || f->kind == FUNCTION_VERSINE;
  c->command = 0;
  seen_add_input(port, 1, sight.n_cause++, -1);
}

/* Those of a motor, actuator, rotor or load: of its function, and of the last act that drives it. */
static void seen_add_actor(const scene *s, scene_actor actor, int at, const function *f, int act)
{
  int port[3], n;
  double weight[3];
  plant.desc.n_in = 0;
  n = plant_actor(s, actor, at, port, weight);
  for (int k = 0; k < n; k++) {
    if (f) {
      seen_add_cause(s, plant.desc.in[port[k]], weight[k], f);
    }
    for (int a = act; a >= 0; a = s->act[a].next) {
      seen_add_input(plant.desc.in[port[k]], weight[k], 0, a);
    }
  }
}

/* What an act does by a command of 1, of all commands of controllers from 0 on. One that pushes one way alone does a half, its
   opposite the other. */
static double seen_gain(const scene *s, int act, int command)
{
  for (int k = 0; k < s->n_control; k++) {
    const scene_control *const c = &s->control[k];
    const scene_allocation *const a = &s->allocation[c->allocation];
    if (command < c->n_command) {
      const scene_act *const it = &s->act[act];
      const double part = fabs(it->low) > 0 && fabs(it->high) > 0 ? 1 : 0.5;
      return act >= a->first && act < a->first + a->n_act ? part * it->gain[c->to + command] : 0;
    }
    command -= c->n_command;
  }
  return 0;
}

/* Commands of all controllers. */
static int seen_commands(const scene *s)
{
  int n = 0;
  for (int k = 0; k < s->n_control; k++) {
    n += s->control[k].n_command;
  }
  return n;
}

static void seen_find_causes(const scene *s)
{
  sight.n_input = 0;
  sight.n_cause = 1 + seen_commands(s);
  for (int k = 0; k < sight.n_cause; k++) {
    sight.cause[k].size = 1;
    sight.cause[k].frequency = HUGE_VAL;
    sight.cause[k].smooth = 0;
    sight.cause[k].command = k;
    memset(sight.cause[k].b, 0, sizeof sight.cause[k].b);
  }
  for (int k = 0; k < s->n_drive; k++) {
    const scene_drive *const d = &s->drive[k];
    const scene_joint *const joint = &s->joint[d->joint];
    const int axes = scene_axes(joint), mode = (int)engine.system_state.mode[joint->at][axes < 3 ? d->axis : 0];
    if (d->kind == SCENE_MOTOR && !joint->loop && mode == FB_AXIS_FREE && axes < 6) {
      seen_add_actor(s, SCENE_BY_MOTOR, k, d->act < 0 ? &d->f : NULL, d->act);
    } else if (d->kind == SCENE_SPEED && axes == 6 && mode == FB_AXIS_PRESCRIBED) {
      const fb_port port = {d->axis < 3 ? FB_PORT_BASE_VELOCITY : FB_PORT_BASE_RATE, joint->at, 0, d->axis % 3,
                            FB_AXES_BODY};
      seen_add_cause(s, port, 1, &d->f);
    }
  }
  for (int k = 0; k < s->n_spring; k++) {
    if (s->spring[k].pulls || s->spring[k].act >= 0) {
      seen_add_actor(s, SCENE_BY_PULL, k, s->spring[k].pulls ? &s->spring[k].pull : NULL, s->spring[k].act);
    }
  }
  for (int k = 0; k < s->n_load; k++) {
    const scene_load *const load = &s->load[k];
    seen_add_actor(s, SCENE_BY_LOAD, k, load->act < 0 ? &load->f : NULL, load->act);
  }
  for (int k = 0; k < s->n_rotor; k++) {
    seen_add_actor(s, SCENE_BY_ROTOR, k, &s->rotor[k].f, s->rotor[k].act);
  }
  for (int k = 0; k < s->n_motion; k++) {
    for (int i = 0; i < 3 && !s->motion[k].support; i++) {
      const fb_port port = {s->motion[k].rate ? FB_PORT_BASE_RATE : FB_PORT_BASE_VELOCITY, 0, 0, i, FB_AXES_BODY};
      seen_add_cause(s, port, s->motion[k].vector[i], &s->motion[k].f);
    }
  }
}

/* ---- what its outputs are */

static void seen_add_row(int output, const fb_port *port, int power, double factor)
{
  seen_row *const row = &sight.row[sight.n_row++];
  memset(row, 0, sizeof *row);
  row->output = output;
  row->is_port = port != NULL;
  if (port) {
    row->port = *port;
  }
  row->power = power;
  row->factor = factor;
  sight.judged[output] = 1;
}

/* Rows of an output that is not a sensor of the linear model, but that three axes of one tell: in inertial axes, or a
   rate or an integral of it. */
static void seen_add_alike(const scene *s, int output)
{
  static const struct {
    scene_quantity quantity;
    fb_port_kind kind;
    int power;
  } alike[] = {{SCENE_POSITION, FB_PORT_ACCELERATION, -2},
               {SCENE_VELOCITY, FB_PORT_ACCELERATION, -1},
               {SCENE_ACCELERATION, FB_PORT_ACCELERATION, 0},
               {SCENE_RATE, FB_PORT_RATE, 0},
               {SCENE_RATE_DOT, FB_PORT_RATE, 1}};
  const scene_output *const o = &s->output[output];
  for (int k = 0; k < (int)(sizeof alike / sizeof *alike); k++) {
    for (int i = 0; i < 3 && alike[k].quantity == o->quantity; i++) {
      const fb_port port = {alike[k].kind, o->body, o->at, i, FB_AXES_BODY};
      seen_add_row(output, &port, alike[k].power, 1);
    }
  }
  if (o->quantity == SCENE_COORDINATE_ACCELERATION && scene_axes(&s->joint[o->at]) < 3 && !s->joint[o->at].loop) {
    const fb_port port = {FB_PORT_SPEED, s->joint[o->at].at, 0, o->axis, FB_AXES_BODY};
    seen_add_row(output, &port, 1, 1);
  }
  if (o->quantity == SCENE_TENSION) {
    const fb_port port = {FB_PORT_LENGTH, o->at, 0, 0, FB_AXES_BODY};
    seen_add_row(output, &port, 0, (double)s->spring[o->at].desc.stiffness);
  }
}

static void seen_find_rows(const scene *s)
{
  sight.n_row = 0;
  memset(sight.judged, 0, sizeof sight.judged);
  for (int k = 0; k < s->n_output; k++) {
    const scene_output *const o = &s->output[k];
    int at;
    plant.desc.n_out = 0;
    at = plant_sensor(s, o);
    if (at >= 0) {
      seen_add_row(k, &plant.desc.out[at], 0, 1);
    } else if (o->quantity == SCENE_ATTITUDE || o->quantity == SCENE_MODE || o->quantity == SCENE_STRAIN ||
               o->quantity == SCENE_MODE_RATE) {
      seen_add_row(k, NULL, o->quantity == SCENE_MODE_RATE, 1);
    } else {
      seen_add_alike(s, k);
    }
  }
}

/* ---- the linear model, as many times as its ports take */

/* A number of a column of B: of its cause, or of all commands that move it. */
static void seen_take_input(const scene *s, const seen_input *in, int i, fb_real b)
{
  if (in->act < 0) {
    sight.cause[in->cause].b[i] = b;
  }
  for (int k = 0; k < seen_commands(s) && in->act >= 0; k++) {
    sight.cause[1 + k].b[i] += (fb_real)(in->weight * seen_gain(s, in->act, k)) * b;
  }
}

static fb_status seen_linearize(const scene *s)
{
  const fb_linear *const l = &plant.linear;
  int input = 0, row = 0;
  fb_status status = FB_OK;
  do {
    const int from = input;
    int own[FB_MAX_PORTS];
    fb_linear_desc *const d = &plant.desc;
    memset(d, 0, sizeof *d);
    for (; input < sight.n_input && d->n_in < FB_MAX_PORTS; input++) {
      d->in[d->n_in++] = sight.input[input].port;
    }
    for (; row < sight.n_row && d->n_out < FB_MAX_PORTS; row++) {
      if (sight.row[row].is_port) {
        own[d->n_out] = row;
        d->out[d->n_out++] = sight.row[row].port;
      }
    }
    status = plant_solve(s);
    for (int i = 0; i < l->n && status == FB_OK; i++) {
      sight.cause[0].b[i] = l->rate[i];
      for (int k = 0; k < d->n_in; k++) {
        seen_take_input(s, &sight.input[from + k], i, l->B[l->n_in * i + k]);
      }
      for (int k = 0; k < d->n_out; k++) {
        sight.row[own[k]].c[i] = (double)l->C[l->n * k + i];
      }
    }
  } while (status == FB_OK && (input < sight.n_input || row < sight.n_row));
  for (int k = 0; k < sight.n_row && status == FB_OK; k++) {
    const scene_output *const o = &s->output[sight.row[k].output];
    scene_output as = *o;
    as.quantity = o->quantity == SCENE_MODE_RATE ? SCENE_MODE : o->quantity;
    if (!sight.row[k].is_port && !plant_add_state(s, sight.row[k].c, &as, 1)) {
      sight.judged[sight.row[k].output] = 0;
    }
  }
  return status;
}

/* ---- residues */

/* x = (z - A)^-1 b of all causes. */
static void seen_answer(double complex z)
{
  const int n = plant.linear.n;
  double complex *const M = sight.M;
  for (int i = 0; i < n * n; i++) {
    M[i] = (i % (n + 1) ? 0 : z) - (double)plant.linear.A[i];
  }
  for (int e = 0; e < sight.n_cause; e++) {
    for (int i = 0; i < n; i++) {
      sight.x[e][i] = (double)sight.cause[e].b[i];
    }
  }
  for (int k = 0; k < n; k++) {
    int pivot = k;
    for (int i = k + 1; i < n; i++) {
      pivot = cabs(M[n * i + k]) > cabs(M[n * pivot + k]) ? i : pivot;
    }
    for (int j = k; j < n && pivot != k; j++) {
      const double complex swap = M[n * k + j];
      M[n * k + j] = M[n * pivot + j];
      M[n * pivot + j] = swap;
    }
    for (int e = 0; e < sight.n_cause; e++) {
      const double complex swap = sight.x[e][k];
      sight.x[e][k] = sight.x[e][pivot];
      sight.x[e][pivot] = swap;
    }
    for (int i = k + 1; i < n; i++) {
      const double complex f = M[n * i + k] / M[n * k + k];
      for (int j = k + 1; j < n && cabs(f) > 0; j++) {
        M[n * i + j] -= f * M[n * k + j];
      }
      for (int e = 0; e < sight.n_cause; e++) {
        sight.x[e][i] -= f * sight.x[e][k];
      }
    }
  }
  for (int e = 0; e < sight.n_cause; e++) {
    for (int i = n - 1; i >= 0; i--) {
      for (int j = i + 1; j < n; j++) {
        sight.x[e][i] -= M[n * i + j] * sight.x[e][j];
      }
      sight.x[e][i] /= M[n * i + i];
    }
  }
}

/* What is left of an answer to a jump by a cause that does not jump, at |lambda|. */
static double seen_left(const seen_cause *c, double size)
{
  const double part = c->frequency < size ? c->frequency / size : 1;
  return c->smooth ? part * part : part;
}

/* Amounts of a mode in all outputs. */
static void seen_take_mode(int mode, double re, double im)
{
  const double complex lambda = re + im * (double complex)_Complex_I;
  const double size = cabs(lambda), off = 1e-6 * size;
  seen_answer(lambda + off);
  for (int e = 0; e < sight.n_cause; e++) {
    double part[SCENE_OUTPUTS] = {0};
    for (int k = 0; k < sight.n_row; k++) {
      const seen_row *const row = &sight.row[k];
      double complex y = 0;
      for (int i = 0; i < plant.linear.n; i++) {
        y += row->c[i] * sight.x[e][i];
      }
      part[row->output] = hypot(part[row->output], row->factor * pow(size, row->power) * cabs(y));
    }
    for (int o = 0; o < SCENE_OUTPUTS; o++) {
      const seen_cause *const c = &sight.cause[e];
      sight.amount[c->command][o][mode] += 2 * off / size * c->size * seen_left(c, size) * part[o];
    }
  }
}

/* Does the mode swing in the run? What is slower drifts, like rigid motion, and what grows as fast falls. */
static int seen_swings(const scene *s, int mode)
{
  const double re = (double)engine.spectrum.re[mode], im = (double)engine.spectrum.im[mode];
  return im * s->duration > 1 && re < 0.5 * im;
}

/* All amounts, about the start; engine.spectrum has the modes, if it is there. */
static void scene_see(const scene *s, int has_spectrum)
{
  sight.known = 0;
  memset(sight.amount, 0, (size_t)(1 + seen_commands(s)) * sizeof sight.amount[0]);
  if (s->n_output == 0 || !has_spectrum || plant_begin(s) != FB_OK) {
    return;
  }
  seen_find_causes(s);
  seen_find_rows(s);
  if (seen_linearize(s) != FB_OK) {
    return;
  }
  for (int k = 0; k < engine.spectrum.n; k++) {
    if (seen_swings(s, k)) {
      seen_take_mode(k, (double)engine.spectrum.re[k], (double)engine.spectrum.im[k]);
    }
  }
  sight.known = 1;
}

/* ---- ranges of outputs, of rigid bodies or of the run */

static void seen_note_nothing(void)
{
  for (int k = 0; k < SCENE_OUTPUTS; k++) {
    engine.lowest[k] = HUGE_VAL;
    engine.highest[k] = -HUGE_VAL;
  }
  memset(engine.command, 0, sizeof engine.command);
}

static void seen_note(const scene *s, int output, double value)
{
  engine.lowest[output] = fmin(engine.lowest[output], value);
  engine.highest[output] = fmax(engine.highest[output], value);
  for (int k = 0, c = 0; k < s->n_control; k++) {
    for (int i = 0; i < s->control[k].n_command; i++, c++) {
      engine.command[c] = fmax(engine.command[c], fabs(remembered[s->control[k].acting + i]));
    }
  }
}

/* Amplitudes of the modes in an output, in parts of its range; swings: its modes may go beyond what is noted. 0: nothing
   is known of it. */
static int seen_amplitudes(fb_real amplitude[FB_MAX_LINEAR], const scene *s, int output, int swings)
{
  double own[FB_MAX_LINEAR], sum = 0, range = fmax(0, engine.highest[output] - engine.lowest[output]);
  if (!sight.known || !sight.judged[output]) {
    return 0;
  }
  for (int k = 0; k < engine.spectrum.n; k++) {
    own[k] = sight.amount[0][output][k];
    for (int c = 0; c < seen_commands(s); c++) {
      own[k] += engine.command[c] * sight.amount[1 + c][output][k];
    }
    sum += own[k];
  }
  range = swings ? fmax(range, sum) : range;
  for (int k = 0; k < engine.spectrum.n && range > 0; k++) {
    const double grown = fmax(0, (double)engine.spectrum.re[k]) * s->duration; /* what a run grew to is in its range */
    amplitude[k] = (fb_real)(swings ? own[k] / range : fmin(own[k] / range, exp(-grown)));
  }
  return sum > 0 && range > 0 && isfinite(sum / range);
}

/* ---- what is told */

/* The body whose modal coordinates a mode moves most; else that of a joint. */
static const char *seen_body(const scene *s, int mode)
{
  int all = plant_axes_before(s, s->n_body), total = all, body = 0;
  double most = -1;
  for (int b = 0; b < s->n_body; b++) {
    total += engine.body[b].n;
  }
  for (int b = 0, i = all; b < s->n_body; b++) {
    for (int a = 0; a < engine.body[b].n; a++, i++) {
      const double size =
          hypot((double)engine.spectrum.shape_re[mode * total + i], (double)engine.spectrum.shape_im[mode * total + i]);
      body = size > most ? b : body;
      most = fmax(most, size);
    }
  }
  return s->body[body].name;
}

/* After a run in steps of dt: outputs whose modes err by more than `allowed` of their range, and the worst mode. */
static void scene_tell_unresolved(scene *s, fb_integrator integrator, double dt, double allowed, FILE *warn)
{
  static fb_real amplitude[FB_MAX_LINEAR];
  for (int k = 0; k < s->n_output; k++) {
    double error, most = 0;
    int mode = 0;
    if (!seen_amplitudes(amplitude, s, k, 0)) {
      continue;
    }
    error = (double)fb_spectrum_error(&engine.spectrum, integrator, amplitude, (fb_real)dt, (fb_real)s->duration);
    if (!(error > allowed)) {
      continue;
    }
    for (int i = 0; i < engine.spectrum.n; i++) {
      static fb_real one[FB_MAX_LINEAR];
      double part;
      memset(one, 0, sizeof one);
      one[i] = amplitude[i];
      part = (double)fb_spectrum_error(&engine.spectrum, integrator, one, (fb_real)dt, (fb_real)s->duration);
      mode = part > most ? i : mode;
      most = fmax(most, part);
    }
    scene_warn(
        s, warn,
        "warning: output %s is not resolved: steps of %.3g s err by some %.2g %% of its range, most of it by mode "
        "%d of %.4g rad/s, of body %s",
        s->output[k].label, dt, 100 * fmin(error, 1), mode + 1, (double)engine.spectrum.im[mode], seen_body(s, mode));
  }
}
#endif
