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
#include "scene_linear.h"
#include <complex.h>

#define LOOP_ORDER (FB_MAX_LINEAR + 64) /* of plant, delays and controllers */
#define LOOP_POINTS 16384

typedef struct loop_margins {
  double gain, gain_at, reduction, reduction_at, phase, phase_at, delay, delay_at, radius; /* at: [rad/s] */
  double shown[3]; /* [deg] about the phase of the file at gain_at, reduction_at and phase_at */
} loop_margins;

typedef struct loop_point {
  double omega;
  double complex L;
} loop_point;

static struct scene_loops {
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

static int loop_fail(scene *s, int line, const char *what, const char *why)
{
  return scene_fail_at(s, line, "margins: %s %s", what, why);
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
  if (s->is_exact) {
    return loop_fail(s, line, "an exact beam", "has no linear model here");
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
  fb_status status = plant_begin(s);
  int port[3];
  double by[3];
  for (int k = 0; k < s->n_control && status == FB_OK; k++) {
    const scene_control *const c = &s->control[k];
    const int n = plant_actor(s, c->actor, c->at, port, by);
    for (int i = 0; i < n; i++) {
      if (port[i] < 0) {
        return loop_fail(s, c->line, c->name, "and the controllers before it have too many commands");
      }
    }
    for (int i = 0; i < c->n_sensor; i++) {
      if (plant_sensor(s, &s->output[c->sensor[i].output]) == -2) {
        return loop_fail(s, c->line, c->name, "and the controllers before it have too many inputs");
      }
    }
  }
  status = status ? status : plant_solve(s);
  return status ? scene_fail_at(s, line, "margins: no linear model about the start: %s%s", fb_status_string(status),
                                refusal_detail(status))
                : 0;
}

/* B, C and D of the commands and of what a controller adds up. */
static int loop_connect(scene *s)
{
  const fb_linear *const linear = &plant.linear;
  const int n = linear->n;
  int port[SCENE_CONTROLS][3], parts[SCENE_CONTROLS];
  double by[SCENE_CONTROLS][3];
  memset(loops.B, 0, sizeof loops.B);
  memset(loops.C, 0, sizeof loops.C);
  memset(loops.D, 0, sizeof loops.D);
  for (int k = 0; k < s->n_control; k++) {
    parts[k] = plant_actor(s, s->control[k].actor, s->control[k].at, port[k], by[k]);
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
      const int at = plant_sensor(s, o);
      if (at < 0 && !plant_add_state(s, loops.C[k], o, c->sensor[j].gain)) {
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
  const int n = plant.linear.n;
  loops.n = loops.order = n;
  loops.sample = T;
  memcpy(loops.A, plant.linear.A, (size_t)(n * n) * sizeof *loops.A);
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

/* Points between those whose chord would be seen as a corner of the Nyquist curve. */
static void loop_smooth(void)
{
  int before;
  do {
    before = loops.n_point;
    for (int k = 0; k + 1 < before && loops.n_point < LOOP_POINTS; k++) {
      const loop_point *const p = &loops.point[k];
      const double omega = 0.5 * (p[0].omega + p[1].omega);
      if (cabs(p[1].L - p[0].L) > 0.05 * fmax(1, cabs(p[0].L)) && p[1].omega - p[0].omega > 1e-9 * omega) {
        loops.point[loops.n_point++] = (loop_point){omega, loop_gain(omega)};
      }
    }
    qsort(loops.point, (size_t)loops.n_point, sizeof *loops.point, loop_lower);
  } while (loops.n_point > before);
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
  loop_margins *const m = &loops.margins[k];
  const double at[3] = {m->gain_at, m->reduction_at, m->phase_at};
  double turn = 0, last = 0;
  for (int p = 0; p < loops.n_point; p++) {
    const double complex L = loops.point[p].L;
    const double angle = carg(L);
    turn += p == 0 ? (angle > 0 ? -2 * function_pi : 0) : -2 * function_pi * round((angle - last) / (2 * function_pi));
    last = angle;
    for (int i = 0; i < 3; i++) {
      m->shown[i] = loops.point[p].omega <= at[i] ? (angle + turn) * 180 / function_pi : m->shown[i];
    }
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
  csv = name ? output_open(name) : NULL;
  if (name && !csv) {
    return scene_fail(s, "cannot write %s: %s", name, output_why());
  }
  if (csv) {
    fputs("loop,omega [rad/s],gain [dB],phase [deg],re [-],im [-]\n", csv);
  }
  failed = 0;
  for (int k = 0; k < s->n_control && !failed; k++) {
    failed = loop_open(s, k, radius);
    if (csv && !failed) {
      loop_smooth();
      loop_write(s, csv, k);
    }
    if (talk && !failed) {
      loop_tell(s, talk, k);
    }
  }
  if (csv && failed) {
    output_drop(csv, name);
  } else if (csv && !output_is_whole(csv, name)) {
    failed = scene_fail(s, "cannot write %s: %s%s", name, strerror(errno), output_left(name));
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
