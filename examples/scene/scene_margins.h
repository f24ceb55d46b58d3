/* scene_margins.h - the loops of a scene's controllers, linear about its start: margins, poles, response over frequency.
   See scene.h.

   The plant d/dt x = A x + B u, y = C x + D u of fb_body_linearize or fb_system_linearize is held between samples of
   T [s], exactly. A command that is D = m T - q late, 0 <= q < T, acts in the last part q of a sample:

     x_{k+1} = F(T) x_k + F(q) G(T - q) u_{k-m} + G(q) u_{k-m+1},   F(t) = e^{A t},  G(t) = int_0^t e^{A s} ds B

   A sensor sees the state before the instant, and what acted before it. The loop of a controller is cut at its command:
   w in place of the command gives -L(z) w as the command that would have been, all other loops closed. L is computed at
   z = e^{i omega T} up to half the frequency of the samples; saturate and quantize count as 1.

   gain_margin      the least factor above 1 by which the loop reaches -1 (no crossing: infinite)
   gain_reduction   the largest below 1 (no crossing: 0)
   phase_margin     [rad] the smallest |arg(-L)| where |L| = 1 (no crossing: pi)
   delay_margin     [s] the smallest lag of the phase to -1 there, by its frequency (no crossing: infinite)
   pole_radius      the largest |z| of all poles of the closed loops. Above 1 + 1e-6 they are unstable, and there are
                    no margins: 1, 1, 0 and 0 */
#ifndef SCENE_MARGINS_H
#define SCENE_MARGINS_H
#include "scene_engine.h"
#include <complex.h>

#define LOOP_ORDER (FB_MAX_LINEAR + 64) /* of plant, delays and controllers */
#define LOOP_POINTS 16384

typedef struct loop_margins {
  double gain, gain_at, reduction, reduction_at, phase, phase_at, delay, delay_at, radius; /* at: [rad/s] */
} loop_margins;

typedef struct loop_point {
  double omega;
  double complex L;
} loop_point;

static struct scene_loops {
  fb_linear_desc desc;
  fb_linear linear;
  int n, order;                                      /* of the plant; with delays and controllers */
  double sample;                                     /* [s] */
  fb_real A[FB_MAX_LINEAR * FB_MAX_LINEAR];          /* of the plant */
  double F[FB_MAX_LINEAR * FB_MAX_LINEAR];           /* of one sample */
  double B[SCENE_CONTROLS][FB_MAX_LINEAR];           /* of a command */
  double before[SCENE_CONTROLS][FB_MAX_LINEAR];      /* F(q) G(T - q) */
  double after[SCENE_CONTROLS][FB_MAX_LINEAR];       /* G(q) */
  double C[SCENE_CONTROLS][FB_MAX_LINEAR];           /* what the sensors of a controller add up to.. */
  double D[SCENE_CONTROLS][SCENE_CONTROLS];          /* ..with the commands that act */
  int late[SCENE_CONTROLS], history[SCENE_CONTROLS]; /* m; where past commands stand in the state */
  double part[SCENE_CONTROLS];                       /* q [s] */
  int memory[SCENE_CONTROLS][SCENE_BLOCKS];          /* where blocks stand in the state */
  fb_real H[LOOP_ORDER * LOOP_ORDER];                /* of a loop that is cut, in Hessenberg form */
  double b[LOOP_ORDER], c[LOOP_ORDER];
  fb_real X[2 * LOOP_ORDER * LOOP_ORDER], work[4 * LOOP_ORDER * LOOP_ORDER];
  fb_real re[LOOP_ORDER], im[LOOP_ORDER];
  double complex M[LOOP_ORDER * LOOP_ORDER];
  int n_point;
  loop_point point[LOOP_POINTS]; /* ascending */
  loop_margins margins[SCENE_CONTROLS];
} loops;

/* ---- the plant: inputs and outputs of its linear model */

static int loop_fail(scene *s, int line, const char *what, const char *why)
{
  return scene_fail_at(s, line, "margins: %s %s", what, why);
}

/* The port of the model, new or there already; -1: there are too many. */
static int loop_port(fb_port *port, int *n, fb_port_kind kind, int body, int node, int axis)
{
  const fb_port wanted = {kind, body, node, axis};
  for (int k = 0; k < *n; k++) {
    if (port[k].kind == kind && port[k].body == body && port[k].node == node && port[k].axis == axis) {
      return k;
    }
  }
  if (*n == FB_MAX_PORTS) {
    return -1;
  }
  port[*n] = wanted;
  return (*n)++;
}

/* What a controller acts by, as ports and their weights: how many there are. */
static int loop_actor(const scene *s, const scene_control *c, int port[3], double weight[3])
{
  fb_linear_desc *const d = &loops.desc;
  const scene_load *const load = &s->load[c->at];
  fb_real vector[3], inertial[3], R[9];
  fb_node_motion node;
  int n = 0;
  weight[0] = 1;
  if (c->actor == SCENE_BY_MOTOR) {
    const scene_drive *const drive = &s->drive[c->at];
    port[0] = loop_port(d->in, &d->n_in, FB_PORT_DRIVE, s->joint[drive->joint].at, 0, drive->axis);
    return 1;
  }
  if (c->actor == SCENE_BY_PULL) {
    port[0] = loop_port(d->in, &d->n_in, FB_PORT_PULL, c->at, 0, 0);
    return 1;
  }
  if (c->actor == SCENE_BY_ROTOR) {
    port[0] = loop_port(d->in, &d->n_in, FB_PORT_MOTOR, s->rotor[c->at].body, 0, s->rotor[c->at].at);
    return 1;
  }
  scene_reals(vector, load->vector, 3);
  if (load->axes == FB_AXES_INERTIAL || load->axes == FB_AXES_NODE) { /* to those of the body */
    if (fb_body_node_motion_eval(&engine.body[load->body], &node, &engine.view.motion.pose[load->body],
                                 &engine.view.motion.motion[load->body], load->node) != FB_OK) {
      return -1;
    }
    fb_quat_to_mat33(R, node.quat);
    fb_mat33_mul_vec3(inertial, R, vector);
    fb_quat_to_mat33(R, engine.view.motion.pose[load->body].quat);
    fb_mat33_mulT_vec3(vector, R, load->axes == FB_AXES_NODE ? inertial : vector);
  }
  for (int i = 0; i < 3; i++) {
    if (FB_FABS(vector[i]) > 0) {
      port[n] = loop_port(d->in, &d->n_in, load->torque ? FB_PORT_TORQUE : FB_PORT_FORCE, load->body, load->node, i);
      weight[n++] = (double)vector[i];
    }
  }
  return n;
}

/* Free axes of the bodies of a system before that one. */
static int loop_axes_before(const scene *s, int body)
{
  int n = 0;
  for (int b = 0; b < body && scene_is_system(s); b++) {
    const fb_joint_kind kind = engine.system.joint[b].kind;
    const int axes = scene_joint_kinds[kind].axes, single = axes < 3;
    for (int i = 0; i < axes; i++) {
      n += engine.system_state.mode[b][single ? i : 0] == FB_AXIS_FREE;
    }
  }
  return n;
}

/* The state that is coordinate k among all free axes and modal coordinates; -1: it is none. */
static int loop_state(const scene *s, int k)
{
  int states = loops.linear.n; /* coordinates and momenta, then rotors */
  for (int r = 0; r < s->n_rotor; r++) {
    states -= !s->body[s->rotor[r].body].level.rotor[s->rotor[r].at].given;
  }
  for (int i = 0; i < states / 2; i++) {
    if (loops.linear.coordinate[i] == k) {
      return i;
    }
  }
  return -1;
}

/* The first state of the attitude of a free body, of three; -1: it has none. */
static int loop_attitude(const scene *s, int body)
{
  if (!scene_is_system(s)) {
    return s->body[0].level.base == FB_BASE_FREE ? loops.linear.n - 3 : -1;
  }
  if (engine.system.joint[body].kind != FB_JOINT_FREE || engine.system_state.mode[body][0] != FB_AXIS_FREE) {
    return -1;
  }
  return loop_state(s, loop_axes_before(s, body) + 3);
}

/* Adds what is part of the state itself to a row of C: attitude, modes, strains. 0: it is not. */
static int loop_add_state(const scene *s, double *row, const scene_output *o, double gain)
{
  const int body = o->body, all = loop_axes_before(s, s->n_body);
  int modes = all, at;
  for (int b = 0; b < body; b++) {
    modes += engine.body[b].n;
  }
  if (o->quantity == SCENE_ATTITUDE) {
    const fb_real *const q = engine.view.motion.pose[body].quat;
    const double turn[4][3] = {{-(double)q[1], -(double)q[2], -(double)q[3]}, /* q (0, e_i) / 2, w to z by rows */
                               {(double)q[0], -(double)q[3], (double)q[2]},
                               {(double)q[3], (double)q[0], -(double)q[1]},
                               {-(double)q[2], (double)q[1], (double)q[0]}};
    at = loop_attitude(s, body);
    for (int i = 0; i < 3 && at >= 0; i++) {
      row[at + i] += gain * 0.5 * turn[o->axis][i];
    }
    return at >= 0;
  }
  for (int a = 0; a < FB_MAX_MODES && (o->quantity == SCENE_MODE || o->quantity == SCENE_STRAIN); a++) {
    const fb_gauge *const gauge = &s->body[body].gauge[o->at];
    const double part = o->quantity == SCENE_MODE ? a == o->at : a < gauge->n ? (double)gauge->gain[a] : 0;
    const int place = engine.place[body][a];
    at = place < 0 || !(fabs(part) > 0) ? 0 : loop_state(s, modes + place);
    if (at < 0) {
      return 0;
    }
    row[at] += place < 0 ? 0 : gain * part;
  }
  return o->quantity == SCENE_MODE || o->quantity == SCENE_STRAIN;
}

/* The port that an output is; -1: it is none, -2: there are too many. */
static int loop_sensor(const scene *s, const scene_output *o)
{
  static const struct {
    scene_quantity quantity;
    fb_port_kind kind;
  } kinds[] = {{SCENE_DISPLACEMENT, FB_PORT_DISPLACEMENT},
               {SCENE_ROTATION, FB_PORT_ROTATION},
               {SCENE_GYRO, FB_PORT_RATE},
               {SCENE_SPIN, FB_PORT_RATE},
               {SCENE_SPECIFIC_FORCE, FB_PORT_ACCELERATION},
               {SCENE_COORDINATE, FB_PORT_COORDINATE},
               {SCENE_COORDINATE_RATE, FB_PORT_SPEED},
               {SCENE_LENGTH, FB_PORT_LENGTH},
               {SCENE_ROTOR_SPEED, FB_PORT_ROTOR_SPEED}};
  fb_linear_desc *const d = &loops.desc;
  for (int k = 0; k < (int)(sizeof kinds / sizeof *kinds); k++) {
    const scene_place place = scene_quantities[o->quantity].place;
    int body = o->body, node = o->at, port;
    if (kinds[k].quantity != o->quantity) {
      continue;
    }
    if (place == SCENE_AT_AXIS) {
      if (scene_axes(&s->joint[o->at]) > 2) {
        return -1;
      }
      body = s->joint[o->at].at;
    } else if (place == SCENE_AT_SPRING) {
      body = o->at;
    }
    node = place == SCENE_AT_NODE ? o->at : 0;
    port = loop_port(d->out, &d->n_out, kinds[k].kind, body, node,
                     place == SCENE_AT_SPRING  ? 0
                     : place == SCENE_AT_ROTOR ? s->rotor[o->at].at
                                               : o->axis);
    return port < 0 ? -2 : port;
  }
  return -1;
}

/* ---- exact discretization */

static void loop_mul(double *out, const double *a, const double *b, int n)
{
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) {
      out[n * i + j] = 0;
    }
    for (int k = 0; k < n; k++) {
      for (int j = 0; j < n && fabs(a[n * i + k]) > 0; j++) {
        out[n * i + j] += a[n * i + k] * b[n * k + j];
      }
    }
  }
}

/* F(t), and column G(t) of B: the exponential of the plant with its input, by its series and squaring. */
static void loop_hold(double *F, double *G, const fb_real *A, const double *B, int n, double t)
{
  static double M[(FB_MAX_LINEAR + 1) * (FB_MAX_LINEAR + 1)], sum[(FB_MAX_LINEAR + 1) * (FB_MAX_LINEAR + 1)];
  static double term[(FB_MAX_LINEAR + 1) * (FB_MAX_LINEAR + 1)], next[(FB_MAX_LINEAR + 1) * (FB_MAX_LINEAR + 1)];
  const int m = n + 1;
  const size_t size = (size_t)(m * m) * sizeof *M;
  double most = 0;
  int halved = 0;
  memset(M, 0, size);
  for (int i = 0; i < n; i++) {
    double row = fabs(B[i] * t);
    for (int j = 0; j < n; j++) {
      M[m * i + j] = (double)A[n * i + j] * t;
      row += fabs(M[m * i + j]);
    }
    M[m * i + n] = B[i] * t;
    most = fmax(most, row);
  }
  for (; most > 0.5 && halved < 1000; most /= 2) {
    halved++;
  }
  memset(sum, 0, size);
  for (int i = 0; i < m * m; i++) {
    M[i] = ldexp(M[i], -halved);
    sum[i] = i % (m + 1) == 0;
  }
  memcpy(term, sum, size);
  for (int k = 1; k <= 18; k++) { /* 0.5^19/19! = 1.6e-23 */
    loop_mul(next, term, M, m);
    for (int i = 0; i < m * m; i++) {
      term[i] = next[i] / k;
      sum[i] += term[i];
    }
  }
  for (; halved > 0; halved--) {
    loop_mul(next, sum, sum, m);
    memcpy(sum, next, size);
  }
  for (int i = 0; i < n; i++) {
    memcpy(F + n * i, sum + m * i, (size_t)n * sizeof *F);
    G[i] = sum[m * i + n];
  }
}

/* ---- plant, delays and controllers: one sample */

/* next: the state after a sample. cut: the controller in whose place `command` stands, -1: none. Returns what it would
   command. */
static double loop_step(const scene *s, double *next, const double *x, int cut, double command)
{
  double made[SCENE_CONTROLS], asked = 0;
  memset(next, 0, (size_t)loops.order * sizeof *next);
  for (int k = 0; k < s->n_control; k++) {
    const scene_control *const c = &s->control[k];
    double v = 0;
    for (int i = 0; i < loops.n; i++) {
      v -= loops.C[k][i] * x[i];
    }
    for (int l = 0; l < s->n_control; l++) {
      v -= loops.D[k][l] * x[loops.history[l] + loops.late[l] - (loops.part[l] > 0)];
    }
    for (int b = 0; b < c->n_block; b++) {
      const int at = loops.memory[k][b];
      v = control_is_linear(&c->block[b]) ? control_linear(&c->block[b], next + at, x + at, v) : v;
    }
    asked = k == cut ? v : asked;
    made[k] = k == cut ? command : v;
  }
  for (int i = 0; i < loops.n; i++) {
    for (int j = 0; j < loops.n; j++) {
      next[i] += loops.F[loops.n * i + j] * x[j];
    }
  }
  for (int k = 0; k < s->n_control; k++) {
    const double *const past = x + loops.history[k] - 1; /* past[i]: i samples ago */
    const int m = loops.late[k];
    const double acting = m > 0 ? past[m] : made[k], coming = m > 1 ? past[m - 1] : made[k];
    for (int i = 0; i < loops.n; i++) {
      next[i] += loops.before[k][i] * acting + loops.after[k][i] * coming;
    }
    next[loops.history[k]] = made[k];
    for (int i = 1; i <= m; i++) {
      next[loops.history[k] + i] = past[i];
    }
  }
  return asked;
}

/* Columns of one sample: M (order x order), what a command in place of controller `cut` does, and what it would
   command by the state. */
static void loop_matrix(const scene *s, fb_real *M, double *b, double *c, int cut)
{
  static double x[LOOP_ORDER], next[LOOP_ORDER];
  const int n = loops.order;
  memset(x, 0, sizeof x);
  for (int j = 0; j < n; j++) {
    x[j] = 1;
    c[j] = loop_step(s, next, x, cut, 0);
    x[j] = 0;
    for (int i = 0; i < n; i++) {
      M[n * i + j] = (fb_real)next[i];
    }
  }
  loop_step(s, b, x, cut, 1);
}

/* Poles of a matrix, which is lost, into re and im; 0 where they are not found. */
static int loop_poles(fb_real *M)
{
  return fb_eig_general_solve(loops.re, loops.im, loops.X, M, loops.work, loops.order) == FB_OK;
}

/* ---- response over frequency */

/* H, b and c of a loop in coordinates of like size, where H is of Hessenberg form. */
static void loop_reduce(void)
{
  static fb_real scale[LOOP_ORDER], Q[LOOP_ORDER * LOOP_ORDER];
  static double b[LOOP_ORDER], c[LOOP_ORDER];
  const int n = loops.order;
  fbi_balance(loops.H, scale, n);
  fbi_hessenberg(loops.H, Q, n);
  for (int i = 0; i < n; i++) {
    b[i] = c[i] = 0;
    for (int j = 0; j < n; j++) {
      b[i] += (double)Q[n * j + i] * loops.b[j] / (double)scale[j];
      c[i] += (double)Q[n * j + i] * loops.c[j] * (double)scale[j];
    }
  }
  memcpy(loops.b, b, sizeof b);
  memcpy(loops.c, c, sizeof c);
}

/* L = -c (z - H)^-1 b at z = e^{i omega T}. */
static double complex loop_gain(double omega)
{
  static double complex y[LOOP_ORDER];
  const int n = loops.order;
  double complex *const M = loops.M, sum = 0;
  const double complex z = cos(omega * loops.sample) + sin(omega * loops.sample) * (double complex)_Complex_I;
  for (int i = 0; i < n; i++) {
    for (int j = i > 0 ? i - 1 : 0; j < n; j++) {
      M[n * i + j] = -(double)loops.H[n * i + j];
    }
    M[n * i + i] += z;
    y[i] = loops.b[i];
  }
  for (int k = 0; k + 1 < n; k++) {
    double complex f;
    if (cabs(M[n * (k + 1) + k]) > cabs(M[n * k + k])) {
      for (int j = k; j < n; j++) {
        const double complex swap = M[n * k + j];
        M[n * k + j] = M[n * (k + 1) + j];
        M[n * (k + 1) + j] = swap;
      }
      f = y[k];
      y[k] = y[k + 1];
      y[k + 1] = f;
    }
    f = M[n * (k + 1) + k] / M[n * k + k];
    for (int j = k + 1; j < n && cabs(f) > 0; j++) {
      M[n * (k + 1) + j] -= f * M[n * k + j];
    }
    y[k + 1] -= f * y[k];
  }
  for (int i = n - 1; i >= 0; i--) {
    for (int j = i + 1; j < n; j++) {
      y[i] -= M[n * i + j] * y[j];
    }
    y[i] /= M[n * i + i];
    sum -= loops.c[i] * y[i];
  }
  return sum;
}

static int loop_lower(const void *a, const void *b)
{
  const double x = ((const loop_point *)a)->omega, y = ((const loop_point *)b)->omega;
  return (x > y) - (x < y);
}

static void loop_add_point(double omega)
{
  if (omega >= 1e-5 * function_pi / loops.sample && omega <= function_pi / loops.sample &&
      loops.n_point < LOOP_POINTS) {
    loops.point[loops.n_point++].omega = omega;
  }
}

/* Frequencies: 400 in a decade, and as close to the poles of the cut loop as their damping may want; then L there. */
static void loop_grid(void)
{
  const double top = function_pi / loops.sample;
  loops.n_point = 0;
  for (int k = -2000; k <= 0; k++) {
    loop_add_point(k == 0 ? top : top * pow(10, k / 400.0));
  }
  for (int i = 0; i < loops.order; i++) {
    const double omega = atan2((double)loops.im[i], (double)loops.re[i]) / loops.sample;
    for (int k = 0; k <= 36 && omega > 0 && omega < top; k++) {
      const double off = pow(10, -1 - 0.25 * k);
      loop_add_point(omega * (1 - off));
      loop_add_point(omega * (1 + off));
    }
  }
  qsort(loops.point, (size_t)loops.n_point, sizeof *loops.point, loop_lower);
  for (int k = 0; k < loops.n_point; k++) {
    loops.point[k].L = loop_gain(loops.point[k].omega);
  }
}

/* What is zero at a crossing: |L|^2 - 1, or the imaginary part, over |L|. */
static double loop_crossing(double complex L, int phase)
{
  return phase ? cimag(L) / cabs(L) : cabs(L) - 1 / cabs(L);
}

/* Where that changes its sign between two points, by halving. */
static loop_point loop_refine(loop_point low, loop_point high, int phase)
{
  for (int k = 0; k < 100 && high.omega - low.omega > 1e-15 * high.omega; k++) {
    const double omega = 0.5 * (low.omega + high.omega);
    const loop_point middle = {omega, loop_gain(omega)};
    *(loop_crossing(middle.L, phase) * loop_crossing(low.L, phase) > 0 ? &low : &high) = middle;
  }
  return fabs(loop_crossing(low.L, phase)) < fabs(loop_crossing(high.L, phase)) ? low : high;
}

/* A crossing of the negative real axis. */
static void loop_take_phase(loop_margins *m, double complex L, double omega)
{
  const double factor = 1 / cabs(L);
  if (factor >= 1 && factor < m->gain) {
    m->gain = factor;
    m->gain_at = omega;
  } else if (factor < 1 && factor > m->reduction) {
    m->reduction = factor;
    m->reduction_at = omega;
  }
}

/* A crossing of the unit circle: lag is by how much more of it L is at -1. */
static void loop_take_gain(loop_margins *m, double complex L, double omega)
{
  const double angle = carg(-L), lag = angle < 0 ? angle + 2 * function_pi : angle;
  if (fabs(angle) < m->phase) {
    m->phase = fabs(angle);
    m->phase_at = omega;
  }
  if (lag / omega < m->delay) {
    m->delay = lag / omega;
    m->delay_at = omega;
  }
}

/* All crossings between the points; at z = 1 and -1, where L is real, too. A sign that changes where L is infinite, at
   a pole on the circle, is no crossing of the axis. */
static void loop_find_margins(loop_margins *m)
{
  const double top = function_pi / loops.sample;
  const double complex ends[] = {loop_gain(0), loop_gain(top)};
  m->gain = m->delay = HUGE_VAL;
  m->phase = function_pi;
  for (int k = 0; k + 1 < loops.n_point; k++) {
    const loop_point *const p = &loops.point[k];
    for (int phase = 0; phase < 2; phase++) {
      if (loop_crossing(p[0].L, phase) * loop_crossing(p[1].L, phase) <= 0) {
        const loop_point at = loop_refine(p[0], p[1], phase);
        const int met = fabs(loop_crossing(at.L, phase)) < 1e-6;
        if (met && phase && creal(at.L) < 0 && at.omega < top * (1 - 1e-12)) {
          loop_take_phase(m, at.L, at.omega);
        } else if (met && !phase) {
          loop_take_gain(m, at.L, at.omega);
        }
      }
    }
  }
  for (int k = 0; k < 2; k++) { /* not where a pole is, as of integrals: L is another beside it */
    const double complex beside = loops.point[k == 0 ? 0 : loops.n_point - 2].L;
    if (creal(ends[k]) < 0 && cabs(ends[k] - beside) < 0.1 * cabs(beside)) {
      loop_take_phase(m, ends[k], k * top);
    }
  }
}

/* ---- of a scene */

/* What has no linear model, or no loop that one sample describes. */
static int loop_check(scene *s, int line)
{
  if (s->n_control == 0) {
    return loop_fail(s, line, "the scene", "has no controller");
  }
  if (s->is_exact || s->method == FB_METHOD_MULTIPLIERS) {
    return loop_fail(s, line, s->is_exact ? "an exact beam" : "method multipliers", "has no linear model here");
  }
  for (int k = 0; k < s->n_control; k++) {
    const scene_control *const c = &s->control[k];
    if (c->block[c->n_block - 1].kind >= CONTROL_THRUSTER) {
      return loop_fail(s, c->block[c->n_block - 1].line, "a thruster or pulse", "is not linear");
    }
    if (fabs(c->sample - s->control[0].sample) > 1e-12 * c->sample) {
      return loop_fail(s, c->line, c->name, "has another sample than the controllers before it");
    }
  }
  return 0;
}

/* Ports of all commands and sensors, and the linear model. */
static int loop_linearize(scene *s, int line)
{
  fb_real weight[FB_MAX_BODIES][3];
  fb_status status = scene_look(s, 0);
  int port[3];
  double by[3];
  memset(&loops.desc, 0, sizeof loops.desc);
  for (int k = 0; k < s->n_control && status == FB_OK; k++) {
    const scene_control *const c = &s->control[k];
    const int n = loop_actor(s, c, port, by);
    for (int i = 0; i < n; i++) {
      if (port[i] < 0) {
        return loop_fail(s, c->line, c->name, "and the controllers before it have too many commands");
      }
    }
    for (int i = 0; i < c->n_sensor; i++) {
      if (loop_sensor(s, &s->output[c->sensor[i].output]) == -2) {
        return loop_fail(s, c->line, c->name, "and the controllers before it have too many inputs");
      }
    }
  }
  scene_drop_weight(s, weight);
  if (scene_is_system(s)) {
    system_input(s, &engine.system_at[0], 0, 0);
    status = status ? status
                    : fb_system_linearize(&engine.system, engine.body, &engine.system_analyse, &loops.linear,
                                          &engine.system_state, &engine.system_at[0], &loops.desc);
  } else {
    single_input(s, &engine.at[0], 0, 0);
    status = status ? status
                    : fb_body_linearize(&engine.body[0], &engine.analyse, &loops.linear, &engine.state, &engine.at[0],
                                        &loops.desc);
  }
  scene_put_weight(s, weight);
  return status ? scene_fail_at(s, line, "margins: no linear model about the start: %s%s", fb_status_string(status),
                                refusal_detail(status))
                : 0;
}

/* B, C and D of the commands and of what a controller adds up. */
static int loop_connect(scene *s)
{
  const fb_linear *const linear = &loops.linear;
  const int n = linear->n;
  int port[SCENE_CONTROLS][3], parts[SCENE_CONTROLS];
  double by[SCENE_CONTROLS][3];
  memset(loops.B, 0, sizeof loops.B);
  memset(loops.C, 0, sizeof loops.C);
  memset(loops.D, 0, sizeof loops.D);
  for (int k = 0; k < s->n_control; k++) {
    parts[k] = loop_actor(s, &s->control[k], port[k], by[k]);
    for (int p = 0; p < parts[k]; p++) {
      for (int i = 0; i < n; i++) {
        loops.B[k][i] += by[k][p] * (double)linear->B[linear->n_in * i + port[k][p]];
      }
    }
  }
  for (int k = 0; k < s->n_control; k++) {
    const scene_control *const c = &s->control[k];
    for (int j = 0; j < c->n_sensor; j++) {
      const scene_output *const o = &s->output[c->sensor[j].output];
      const int at = loop_sensor(s, o);
      if (at < 0 && !loop_add_state(s, loops.C[k], o, c->sensor[j].gain)) {
        return loop_fail(s, c->line, o->label,
                         "has no linear model: take displacement, rotation, gyro, spin, specific_force, length, "
                         "coordinate, speed, mode, strain, or attitude of a free body");
      }
      for (int i = 0; i < n && at >= 0; i++) {
        loops.C[k][i] += c->sensor[j].gain * (double)linear->C[n * at + i];
      }
      for (int l = 0; l < s->n_control && at >= 0; l++) {
        for (int p = 0; p < parts[l]; p++) {
          loops.D[k][l] += c->sensor[j].gain * by[l][p] * (double)linear->D[linear->n_in * at + port[l][p]];
        }
      }
    }
  }
  return 0;
}

/* The plant over one sample, and where everything stands in the state. */
static int loop_discretize(scene *s, int line)
{
  static fb_real scale[FB_MAX_LINEAR];
  static double F[FB_MAX_LINEAR * FB_MAX_LINEAR], G[FB_MAX_LINEAR];
  const double T = s->control[0].sample;
  const int n = loops.linear.n;
  loops.n = loops.order = n;
  loops.sample = T;
  memcpy(loops.A, loops.linear.A, (size_t)(n * n) * sizeof *loops.A);
  fbi_balance(loops.A, scale, n);
  for (int k = 0; k < s->n_control; k++) {
    const scene_control *const c = &s->control[k];
    const double late = ceil(c->delay / T * (1 - 1e-9)), part = late * T - c->delay;
    loops.late[k] = (int)late;
    loops.part[k] = part > 1e-9 * T ? part : 0;
    for (int i = 0; i < n; i++) {
      loops.B[k][i] /= (double)scale[i];
      loops.C[k][i] *= (double)scale[i];
    }
    loop_hold(F, G, loops.A, loops.B[k], n, T - loops.part[k]);
    loop_hold(loops.F, loops.after[k], loops.A, loops.B[k], n, loops.part[k]);
    for (int i = 0; i < n; i++) {
      loops.before[k][i] = 0;
      for (int j = 0; j < n; j++) {
        loops.before[k][i] += loops.F[n * i + j] * G[j];
      }
    }
    loops.history[k] = loops.order;
    loops.order += loops.late[k] + 1;
    for (int b = 0; b < c->n_block; b++) {
      loops.memory[k][b] = loops.order;
      loops.order += c->block[b].n;
    }
    if (loops.order > LOOP_ORDER) {
      return loop_fail(s, line, c->name, "and the controllers before it have too many states, delays among them");
    }
  }
  loop_hold(loops.F, G, loops.A, loops.B[0], n, T);
  return 0;
}

/* A loop, from its cut: its response over frequency, and its margins unless the closed loops are unstable. */
static int loop_open(scene *s, int k, double radius)
{
  static fb_real M[LOOP_ORDER * LOOP_ORDER];
  loop_margins *const m = &loops.margins[k];
  loop_matrix(s, loops.H, loops.b, loops.c, k);
  memcpy(M, loops.H, sizeof M);
  if (!loop_poles(M)) {
    return loop_fail(s, s->control[k].line, s->control[k].name, "has a loop whose poles are not found");
  }
  loop_reduce();
  loop_grid();
  memset(m, 0, sizeof *m);
  loop_find_margins(m);
  if (radius > 1 + 1e-6) {
    m->gain = m->reduction = 1;
    m->phase = m->delay = 0;
  }
  m->radius = radius;
  return 0;
}

/* The closed loops: the largest |z| of their poles; negative where they are not found. */
static double loop_close(const scene *s)
{
  static fb_real M[LOOP_ORDER * LOOP_ORDER];
  static double b[LOOP_ORDER], c[LOOP_ORDER];
  double radius = 0;
  loop_matrix(s, M, b, c, -1);
  if (!loop_poles(M)) {
    return -1;
  }
  for (int i = 0; i < loops.order; i++) {
    radius = fmax(radius, hypot((double)loops.re[i], (double)loops.im[i]));
  }
  return radius;
}

/* The response of the loop that was cut last: Bode and Nyquist. */
static void loop_write(const scene *s, FILE *csv, int k)
{
  double turn = 0, last = 0;
  for (int p = 0; p < loops.n_point; p++) {
    const double complex L = loops.point[p].L;
    const double angle = carg(L);
    turn += p == 0 ? (angle > 0 ? -2 * function_pi : 0) : -2 * function_pi * round((angle - last) / (2 * function_pi));
    last = angle;
    fprintf(csv, "%s,%.12g,%.12g,%.12g,%.12g,%.12g\n", s->control[k].name, loops.point[p].omega, 20 * log10(cabs(L)),
            (angle + turn) * 180 / function_pi, creal(L), cimag(L));
  }
}

static void loop_tell_factor(FILE *talk, const char *what, double factor, double omega)
{
  if (factor > 0 && factor < HUGE_VAL) {
    fprintf(talk, " %s %.4g (%.3g dB) at %.4g rad/s,", what, factor, 20 * log10(factor), omega);
  } else {
    fprintf(talk, " no %s,", what);
  }
}

static void loop_tell(const scene *s, FILE *talk, int k)
{
  const loop_margins *const m = &loops.margins[k];
  const char *const name = s->control[k].name;
  if (m->radius > 1 + 1e-6) {
    fprintf(talk, "%s: the closed loop is unstable, |z| = %.9g of a pole\n", name, m->radius);
    return;
  }
  fprintf(talk, "%s:", name);
  loop_tell_factor(talk, "gain margin", m->gain, m->gain_at);
  loop_tell_factor(talk, "gain reduction", m->reduction, m->reduction_at);
  if (m->delay < HUGE_VAL) {
    fprintf(talk, " phase margin %.4g rad (%.3g deg) at %.4g rad/s, delay margin %.4g s at %.4g rad/s;", m->phase,
            m->phase * 180 / function_pi, m->phase_at, m->delay, m->delay_at);
  } else {
    fputs(" no phase margin;", talk);
  }
  fprintf(talk, " |z| of the poles at most %.9g\n", m->radius);
}

/* Margins of all loops about the start, and their response to a file, as far as they are asked for. */
static int scene_measure_margins(scene *s, const char *name, FILE *talk)
{
  FILE *csv = NULL;
  double radius;
  int line = 0, failed;
  for (int k = 0; k < s->n_measure; k++) {
    line = line == 0 && s->measure[k].kind >= SCENE_GAIN_MARGIN ? s->measure[k].line : line;
  }
  if (line == 0 && !name) {
    return 0;
  }
  if (loop_check(s, line) || loop_linearize(s, line) || loop_connect(s) || loop_discretize(s, line)) {
    return 1;
  }
  radius = loop_close(s);
  if (radius < 0) {
    return loop_fail(s, line, "the closed loops", "have poles that are not found");
  }
  csv = name ? fopen(name, "w") : NULL;
  if (name && !csv) {
    return scene_fail(s, "cannot write %s: %s", name, strerror(errno));
  }
  if (csv) {
    fputs("loop,omega [rad/s],gain [dB],phase [deg],re [-],im [-]\n", csv);
  }
  failed = 0;
  for (int k = 0; k < s->n_control && !failed; k++) {
    failed = loop_open(s, k, radius);
    if (csv && !failed) {
      loop_write(s, csv, k);
    }
    if (talk && !failed) {
      loop_tell(s, talk, k);
    }
  }
  if (csv && !output_is_whole(csv) && !failed) {
    failed = scene_fail(s, "cannot write %s: %s", name, strerror(errno));
  }
  for (int k = 0; k < s->n_measure && !failed; k++) {
    const loop_margins *const m = &loops.margins[s->measure[k].kind >= SCENE_GAIN_MARGIN ? s->measure[k].output : 0];
    const double value[] = {m->gain, m->reduction, m->phase, m->delay, m->radius};
    if (s->measure[k].kind >= SCENE_GAIN_MARGIN) {
      s->measured[k] = value[s->measure[k].kind - SCENE_GAIN_MARGIN];
    }
  }
  return failed;
}
#endif
