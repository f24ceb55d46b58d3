/* scene_margins.h - the loops of a scene's controllers, linear about its start: margins, poles, response over frequency.
   See scene.h.

   The plant d/dt x = A x + B u, y = C x + D u of fb_body_linearize or fb_system_linearize is held between samples of
   T [s], exactly. A command that is D = m T - q late, 0 <= q < T, acts in the last part q of a sample:

     x_{k+1} = F(T) x_k + F(q) G(T - q) u_{k-m} + G(q) u_{k-m+1},   F(t) = e^{A t},  G(t) = int_0^t e^{A s} ds B

   A sensor sees the state before the instant, and what acted before it. A loop is cut at a command: w in place of it gives
   -L(z) w as the command that would have been, all other loops closed. Of a controller of several commands each loop is cut
   by itself, and all at once, where L is a matrix. L is computed at z = e^{i omega T} up to half the frequency of the
   samples; saturate, quantize, rate_limit, dead_band and the limits of allocations count as 1, a table as its slope at 0,
   and actuators that push one way alone as one half: their opposites are the other.

   gain_margin      the least factor above 1 by which the loop reaches -1 (no crossing: infinite)
   gain_reduction   the largest below 1 (no crossing: 0)
   phase_margin     [rad] the smallest |arg(-L)| where |L| = 1 (no crossing: pi)
   delay_margin     [s] the smallest lag of the phase to -1 there, by its frequency (no crossing: infinite)
   pole_radius      the largest |z| of all poles of the closed loops. Above 1 + 1e-6 they are unstable, and there are
                    no margins: 1, 1, 0, 0 and 0
   return_difference  the least singular value a of 1 + L over frequency, all commands of the controller cut at once. All of
                    them may change at once by factors from 1/(1 + a) to 1/(1 - a), each by its own, or by phases up to
                    2 asin(a/2) */
#ifndef SCENE_MARGINS_H
#define SCENE_MARGINS_H
#include "scene_seen.h"

#define LOOP_POINTS 16384
#define LOOP_ARRAYS 32

typedef struct loop_margins {
  double gain, gain_at, reduction, reduction_at, phase, phase_at, delay, delay_at, radius; /* at: [rad/s] */
  double shown[3]; /* [deg] about the phase of the file at gain_at, reduction_at and phase_at */
} loop_margins;

typedef struct loop_point {
  double omega;
  double complex L;
} loop_point;

typedef struct loop_cut { /* one sample of what is cut at n commands: H in Hessenberg form, b and c by commands */
  int n, command[CONTROL_SIGNALS];
  fb_real *H;
  double *b, *c;
} loop_cut;

static struct scene_loops {
  int n, order; /* of the plant; with delays and controllers */
  int n_command, n_signal, command[SCENE_CONTROLS], signal[SCENE_CONTROLS]; /* of all controllers; first of each */
  double sample;                                                            /* [s] */
  fb_real *A;                                                               /* of the plant */
  double *F;                                                                /* of one sample */
  double *B, *before, *after;                        /* columns of commands; F(q) G(T - q) and G(q) of them */
  double *C, *D;                                     /* rows of what comes in, of states and of commands that act */
  int late[SCENE_CONTROLS], history[SCENE_COMMANDS]; /* m; where past commands stand in the state */
  double part[SCENE_CONTROLS];                       /* q [s] */
  int memory[SCENE_CONTROLS][SCENE_BLOCKS];          /* where blocks stand in the state */
  loop_cut one, all;                                 /* at a command, and at all of its controller */
  fb_real *X, *work, *re, *im, *M;
  double complex *z;
  double *x, *next;
  int n_array;
  void *array[LOOP_ARRAYS];
  int n_point;
  loop_point point[LOOP_POINTS]; /* ascending */
  loop_margins margins[SCENE_COMMANDS];
  double difference[SCENE_CONTROLS], difference_at[SCENE_CONTROLS]; /* the least singular value of 1 + L; [rad/s] */
} loops;

static int loop_fail(scene *s, int line, const char *what, const char *why)
{
  return scene_fail_at(s, line, "margins: %s %s", what, why);
}

/* ---- memory, for what the scene has */

/* n numbers of zero; NULL: there is no memory. */
static void *loop_room(size_t n, size_t size)
{
  void *const room = loops.n_array < LOOP_ARRAYS ? calloc(n > 0 ? n : 1, size) : NULL;
  if (room) {
    loops.array[loops.n_array++] = room;
  }
  return room;
}

static void loop_release(void)
{
  while (loops.n_array > 0) {
    free(loops.array[--loops.n_array]);
  }
}

static int loop_cut_room(loop_cut *cut, size_t n)
{
  cut->H = (fb_real *)loop_room(n * n, sizeof *cut->H);
  cut->b = (double *)loop_room(n * CONTROL_SIGNALS, sizeof *cut->b);
  cut->c = (double *)loop_room(n * CONTROL_SIGNALS, sizeof *cut->c);
  return cut->H && cut->b && cut->c;
}

/* Of the plant, its commands and signals. 0: there is no memory. */
static int loop_plant_room(size_t n, size_t commands, size_t signals)
{
  loops.A = (fb_real *)loop_room(n * n, sizeof *loops.A);
  loops.F = (double *)loop_room(n * n, sizeof *loops.F);
  loops.B = (double *)loop_room(n * commands, sizeof *loops.B);
  loops.before = (double *)loop_room(n * commands, sizeof *loops.before);
  loops.after = (double *)loop_room(n * commands, sizeof *loops.after);
  loops.C = (double *)loop_room(n * signals, sizeof *loops.C);
  loops.D = (double *)loop_room(commands * signals, sizeof *loops.D);
  return loops.A && loops.F && loops.B && loops.before && loops.after && loops.C && loops.D;
}

/* Of one sample of all. */
static int loop_sample_room(size_t n)
{
  loops.X = (fb_real *)loop_room(2 * n * n, sizeof *loops.X);
  loops.work = (fb_real *)loop_room(4 * n * n, sizeof *loops.work);
  loops.re = (fb_real *)loop_room(n, sizeof *loops.re);
  loops.im = (fb_real *)loop_room(n, sizeof *loops.im);
  loops.M = (fb_real *)loop_room(n * n, sizeof *loops.M);
  loops.z = (double complex *)loop_room(n * (n + CONTROL_SIGNALS), sizeof *loops.z);
  loops.x = (double *)loop_room(n, sizeof *loops.x);
  loops.next = (double *)loop_room(n, sizeof *loops.next);
  return loop_cut_room(&loops.one, n) && loop_cut_room(&loops.all, n) && loops.X && loops.work && loops.re &&
         loops.im && loops.M && loops.z && loops.x && loops.next;
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

/* F(t), and columns G(t) of m columns of B, one after the other: the exponential of the plant with its inputs, by its series
   and squaring. 0: there is no memory. */
static int loop_hold(double *F, double *G, const fb_real *A, const double *B, int n, int m, double t)
{
  const int all = n + m;
  const size_t size = (size_t)(all * all);
  double *const M = (double *)calloc(4 * size, sizeof *M), *const sum = M + size, *const term = sum + size,
                *const next = term + size;
  double most = 0;
  int halved = 0;
  if (!M) {
    return 0;
  }
  for (int i = 0; i < n; i++) {
    double row = 0;
    for (int j = 0; j < all; j++) {
      M[all * i + j] = (j < n ? (double)A[n * i + j] : B[n * (j - n) + i]) * t;
      row += fabs(M[all * i + j]);
    }
    most = fmax(most, row);
  }
  for (; most > 0.5 && halved < 1000; most /= 2) {
    halved++;
  }
  for (int i = 0; i < all * all; i++) {
    M[i] = ldexp(M[i], -halved);
    term[i] = sum[i] = i % (all + 1) == 0;
  }
  for (int k = 1; k <= 18; k++) { /* 0.5^19/19! = 1.6e-23 */
    loop_mul(next, term, M, all);
    for (int i = 0; i < all * all; i++) {
      term[i] = next[i] / k;
      sum[i] += term[i];
    }
  }
  for (; halved > 0; halved--) {
    loop_mul(next, sum, sum, all);
    memcpy(sum, next, size * sizeof *sum);
  }
  for (int i = 0; i < n; i++) {
    memcpy(F + n * i, sum + all * i, (size_t)n * sizeof *F);
    for (int j = 0; j < m; j++) {
      G[n * j + i] = sum[all * i + n + j];
    }
  }
  free(M);
  return 1;
}

/* ---- plant, delays and controllers: one sample */

/* What the blocks of a controller make of the state; next: their states after the sample. */
static void loop_control(const scene *s, int k, double v[CONTROL_SIGNALS], double *next, const double *x)
{
  const scene_control *const c = &s->control[k];
  for (int i = 0; i < c->n_signal; i++) {
    const int signal = loops.signal[k] + i;
    v[i] = 0;
    for (int j = 0; j < loops.n; j++) {
      v[i] -= loops.C[loops.n * signal + j] * x[j];
    }
    for (int l = 0; l < s->n_control; l++) {
      for (int m = loops.command[l]; m < loops.command[l] + s->control[l].n_command; m++) {
        v[i] -= loops.D[loops.n_command * signal + m] * x[loops.history[m] + loops.late[l] - (loops.part[l] > 0)];
      }
    }
  }
  for (int b = 0; b < c->n_block; b++) {
    const int at = loops.memory[k][b];
    double w[CONTROL_SIGNALS];
    if (control_is_linear(&c->block[b])) {
      control_linear(&c->block[b], &s->numbers, w, next + at, x + at, v);
      memcpy(v, w, (size_t)c->block[b].out * sizeof *v);
    } else if (c->block[b].kind == CONTROL_TABLE) {
      for (int i = 0; i < c->block[b].in; i++) {
        v[i] *= function_table(&c->block[b].curve, &s->tables, 0, 0).rate;
      }
    }
  }
}

/* next: the state after a sample. cut: the commands in whose place `command` stands, NULL: none. asked: what would be
   commanded, of all. */
static void loop_step(const scene *s, double *next, const double *x, const loop_cut *cut, const double *command,
                      double asked[SCENE_COMMANDS])
{
  double made[SCENE_COMMANDS];
  memset(next, 0, (size_t)loops.order * sizeof *next);
  for (int k = 0; k < s->n_control; k++) {
    double v[CONTROL_SIGNALS];
    loop_control(s, k, v, next, x);
    memcpy(asked + loops.command[k], v, (size_t)s->control[k].n_command * sizeof *v);
  }
  memcpy(made, asked, (size_t)loops.n_command * sizeof *made);
  for (int k = 0; cut && k < cut->n; k++) {
    made[cut->command[k]] = command[k];
  }
  for (int i = 0; i < loops.n; i++) {
    for (int j = 0; j < loops.n; j++) {
      next[i] += loops.F[loops.n * i + j] * x[j];
    }
  }
  for (int k = 0; k < s->n_control; k++) {
    for (int l = loops.command[k]; l < loops.command[k] + s->control[k].n_command; l++) {
      const double *const past = x + loops.history[l] - 1; /* past[i]: i samples ago */
      const int m = loops.late[k];
      const double acting = m > 0 ? past[m] : made[l], coming = m > 1 ? past[m - 1] : made[l];
      for (int i = 0; i < loops.n; i++) {
        next[i] += loops.before[loops.n * l + i] * acting + loops.after[loops.n * l + i] * coming;
      }
      next[loops.history[l]] = made[l];
      for (int i = 1; i <= m; i++) {
        next[loops.history[l] + i] = past[i];
      }
    }
  }
}

/* Columns of one sample: M (order x order), what each command in place of those that are cut does, and what they would be by
   the state. */
static void loop_matrix(const scene *s, fb_real *M, loop_cut *cut)
{
  const int n = loops.order;
  double asked[SCENE_COMMANDS], command[CONTROL_SIGNALS] = {0}, ignored[SCENE_COMMANDS];
  memset(loops.x, 0, (size_t)n * sizeof *loops.x);
  for (int j = 0; j < n; j++) {
    loops.x[j] = 1;
    loop_step(s, loops.next, loops.x, cut, command, asked);
    loops.x[j] = 0;
    for (int i = 0; i < n; i++) {
      M[n * i + j] = (fb_real)loops.next[i];
    }
    for (int k = 0; cut && k < cut->n; k++) {
      cut->c[n * k + j] = asked[cut->command[k]];
    }
  }
  for (int k = 0; cut && k < cut->n; k++) {
    command[k] = 1;
    loop_step(s, cut->b + n * k, loops.x, cut, command, ignored);
    command[k] = 0;
  }
}

/* Poles of a matrix, which is lost, into re and im; 0 where they are not found. */
static int loop_poles(fb_real *M)
{
  return fb_eig_general_solve(loops.re, loops.im, loops.X, M, loops.work, loops.order) == FB_OK;
}

/* ---- response over frequency */

/* H, b and c of a loop in coordinates of like size, where H is of Hessenberg form. */
static void loop_reduce(loop_cut *cut)
{
  const int n = loops.order;
  fb_real *const scale = loops.work, *const Q = loops.X;
  double *const b = loops.next, *const c = loops.x;
  fbi_balance(cut->H, scale, n);
  fbi_hessenberg(cut->H, Q, n);
  for (int k = 0; k < cut->n; k++) {
    for (int i = 0; i < n; i++) {
      b[i] = c[i] = 0;
      for (int j = 0; j < n; j++) {
        b[i] += (double)Q[n * j + i] * cut->b[n * k + j] / (double)scale[j];
        c[i] += (double)Q[n * j + i] * cut->c[n * k + j] * (double)scale[j];
      }
    }
    memcpy(cut->b + n * k, b, (size_t)n * sizeof *b);
    memcpy(cut->c + n * k, c, (size_t)n * sizeof *c);
  }
}

/* y = (z - H)^-1 b of all that is cut, by elimination with pivots. y: n numbers of each. */
static void loop_answer(const loop_cut *cut, double omega, double complex *M, double complex *y)
{
  const int n = loops.order;
  const double complex z = cos(omega * loops.sample) + sin(omega * loops.sample) * (double complex)_Complex_I;
  for (int i = 0; i < n; i++) {
    for (int j = i > 0 ? i - 1 : 0; j < n; j++) {
      M[n * i + j] = -(double)cut->H[n * i + j];
    }
    M[n * i + i] += z;
  }
  for (int i = 0; i < n * cut->n; i++) {
    y[i] = cut->b[i];
  }
  for (int k = 0; k + 1 < n; k++) {
    const int swap = cabs(M[n * (k + 1) + k]) > cabs(M[n * k + k]);
    double complex f;
    for (int j = k; j < n && swap; j++) {
      const double complex kept = M[n * k + j];
      M[n * k + j] = M[n * (k + 1) + j];
      M[n * (k + 1) + j] = kept;
    }
    f = M[n * (k + 1) + k] / M[n * k + k];
    for (int j = k + 1; j < n && cabs(f) > 0; j++) {
      M[n * (k + 1) + j] -= f * M[n * k + j];
    }
    for (int l = 0; l < cut->n; l++) {
      double complex *const at = y + n * l + k, kept = at[0];
      at[0] = swap ? at[1] : at[0];
      at[1] = (swap ? kept : at[1]) - f * at[0];
    }
  }
  for (int l = 0; l < cut->n; l++) {
    for (int i = n - 1; i >= 0; i--) {
      for (int j = i + 1; j < n; j++) {
        y[n * l + i] -= M[n * i + j] * y[n * l + j];
      }
      y[n * l + i] /= M[n * i + i];
    }
  }
}

/* L = -c (z - H)^-1 b at z = e^{i omega T}, by rows. */
static void loop_response(const loop_cut *cut, double omega, double complex *L)
{
  const int n = loops.order;
  double complex *const y = loops.z + n * n;
  loop_answer(cut, omega, loops.z, y);
  for (int i = 0; i < cut->n; i++) {
    for (int k = 0; k < cut->n; k++) {
      double complex sum = 0;
      for (int j = n - 1; j >= 0; j--) {
        sum -= cut->c[n * i + j] * y[n * k + j];
      }
      L[cut->n * i + k] = sum;
    }
  }
}

static double complex loop_gain(double omega)
{
  double complex L;
  loop_response(&loops.one, omega, &L);
  return L;
}

/* Columns a and b, of n rows, orthogonal by a rotation (Hestenes); how far they were from it. */
static double loop_orthogonal(double complex *M, int n, int a, int b)
{
  double complex off = 0;
  double size[2] = {0, 0}, part, tau, t, c;
  for (int i = 0; i < n; i++) {
    size[0] += creal(M[n * i + a] * conj(M[n * i + a]));
    size[1] += creal(M[n * i + b] * conj(M[n * i + b]));
    off += conj(M[n * i + a]) * M[n * i + b];
  }
  part = cabs(off) / sqrt(size[0] * size[1]);
  if (!(part > 1e-15)) {
    return 0;
  }
  tau = (size[1] - size[0]) / (2 * cabs(off));
  t = (tau < 0 ? -1 : 1) / (fabs(tau) + hypot(1, tau));
  c = 1 / hypot(1, t);
  off /= cabs(off);
  for (int i = 0; i < n; i++) {
    const double complex x = M[n * i + a], y = M[n * i + b] * conj(off);
    M[n * i + a] = c * (x - t * y);
    M[n * i + b] = c * (t * x + y);
  }
  return part;
}

/* The least singular value of 1 + L at a frequency. */
static double loop_difference(double omega)
{
  double complex M[CONTROL_SIGNALS * CONTROL_SIGNALS];
  const int n = loops.all.n;
  double least = HUGE_VAL, most = 1;
  loop_response(&loops.all, omega, M);
  for (int i = 0; i < n; i++) {
    M[(n + 1) * i] += 1;
  }
  for (int sweep = 0; sweep < 40 && most > 1e-13; sweep++) {
    most = 0;
    for (int k = 0; k < n * n; k++) {
      most = k / n < k % n ? fmax(most, loop_orthogonal(M, n, k / n, k % n)) : most;
    }
  }
  for (int j = 0; j < n; j++) {
    double size = 0;
    for (int i = 0; i < n; i++) {
      size = hypot(size, cabs(M[n * i + j]));
    }
    least = fmin(least, size);
  }
  return least;
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

/* Frequencies: 400 in a decade, and as close to the poles of the cut loop as their damping may want. */
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

/* The least of the return difference over frequency, and where: at points, then between those beside each low one. */
static double loop_least_difference(double *at)
{
  static double value[LOOP_POINTS];
  const double golden = 0.5 * (sqrt(5) - 1);
  double least = HUGE_VAL;
  for (int k = 0; k < loops.n_point; k++) {
    value[k] = loop_difference(loops.point[k].omega);
    if (value[k] < least) {
      least = value[k];
      *at = loops.point[k].omega;
    }
  }
  for (int k = 1; k + 1 < loops.n_point; k++) {
    double low = loops.point[k - 1].omega, high = loops.point[k + 1].omega;
    const int is_low = value[k] <= value[k - 1] && value[k] <= value[k + 1] && value[k] < 1.5 * least;
    for (int i = 0; i < 60 && is_low && high - low > 1e-9 * high; i++) {
      const double a = high - golden * (high - low), b = low + golden * (high - low);
      const double x = loop_difference(a), y = loop_difference(b);
      if (fmin(x, y) < least) {
        least = fmin(x, y);
        *at = x < y ? a : b;
      }
      *(x < y ? &high : &low) = x < y ? b : a;
    }
  }
  return least;
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

/* One of the three axes of what a node says, as an output. */
static scene_output loop_axis(scene_quantity quantity, int body, int node, int axis)
{
  scene_output o;
  memset(&o, 0, sizeof o);
  o.quantity = quantity;
  o.body = body;
  o.at = node;
  o.axis = axis;
  return o;
}

/* Ports of all that is commanded, and of all that is seen. */
static int loop_find_ports(scene *s, int in[SCENE_ACTS][3], double by[SCENE_ACTS][3], int parts[SCENE_ACTS])
{
  int least = 0;
  for (int k = 0; k < s->n_act; k++) {
    parts[k] = plant_actor(s, s->act[k].actor, s->act[k].at, in[k], by[k]);
    for (int i = 0; i < parts[k]; i++) {
      least = in[k][i] < least ? in[k][i] : least;
    }
    if (least < 0 || parts[k] < 0) {
      return loop_fail(s, 0, "actuators of controllers", "have too many components");
    }
  }
  for (int k = 0; k < s->n_control; k++) {
    const scene_control *const c = &s->control[k];
    for (int i = 0; i < c->n_sensor; i++) {
      const int port = plant_sensor(s, &s->output[c->sensor[i].output]);
      least = port < least ? port : least;
    }
    for (int i = 0; i < 3 && c->attitude.is; i++) {
      const scene_output turn = loop_axis(SCENE_ROTATION, c->attitude.body, c->attitude.node, i);
      const scene_output gyro = loop_axis(SCENE_GYRO, c->attitude.gyro_body, c->attitude.gyro_node, i);
      const int port = plant_sensor(s, &turn), other = plant_sensor(s, &gyro);
      least = port < least ? port : other < least ? other : least;
    }
    if (least < -1) {
      return loop_fail(s, c->line, c->name, "and the controllers before it have too many inputs");
    }
  }
  return 0;
}

static int loop_no_model(scene *s, const scene_control *c, const char *what)
{
  return loop_fail(s, c->line, what,
                   "has no linear model: take displacement, rotation, gyro, spin, specific_force, length, "
                   "coordinate, speed, mode, strain, or attitude of a free body");
}

/* Adds a sensor of the linear model to what comes in: to a row of C, and to one of D by what each command does there. W: what
   a command does at the inputs of the model. 0: it has none. */
static int loop_add_sensor(const scene *s, int signal, const scene_output *o, double gain, const double *W)
{
  const fb_linear *const linear = &plant.linear;
  const int at = plant_sensor(s, o);
  double *const row = loops.C + loops.n * signal;
  if (at < 0) {
    return plant_add_state(s, row, o, gain);
  }
  for (int i = 0; i < loops.n; i++) {
    row[i] += gain * (double)linear->C[loops.n * at + i];
  }
  for (int l = 0; l < loops.n_command; l++) {
    for (int p = 0; p < linear->n_in; p++) {
      loops.D[loops.n_command * signal + l] +=
          gain * W[loops.n_command * p + l] * (double)linear->D[linear->n_in * at + p];
    }
  }
  return 1;
}

/* Errors of attitude, of small turns d of the node about axes of the body: those of e are s (q_0 d - v x d), q = (q_0, v) the
   turn to what is wanted and s its sign; those of rates are w - o x d, o the rate that is wanted in these axes. The sum of the
   two turns, of the body and of the node in it, is that of small elastic ones. */
static int loop_add_attitude(scene *s, int k, const double *W)
{
  const scene_control *const c = &s->control[k];
  const scene_attitude *const a = &c->attitude;
  const int state = plant_attitude(s, a->body), signal = loops.signal[k];
  fb_node_motion node;
  fb_real q[4], wanted[4], rate[3], off[4], own[3], R[9], N[9], M[9];
  double references[2 * SCENE_TURNS];
  int there = state >= 0;
  if (control_attitude_at(q, &node, a->body, a->node) != FB_OK) {
    return loop_no_model(s, c, "attitude");
  }
  for (int i = 0; i < a->n_turn; i++) {
    const function_value f = function_eval(&a->turn[i].f, &s->tables, 0, timing.slack);
    references[2 * i] = f.value;
    references[2 * i + 1] = f.rate;
  }
  const fb_real back[4] = {q[0], -q[1], -q[2], -q[3]};
  control_wanted(a, references, wanted, rate);
  fb_quat_mul(off, back, wanted);
  fb_quat_to_mat33(R, off);
  fb_mat33_mul_vec3(own, R, rate);
  const double by = off[0] < 0 ? -1 : 1, q0 = (double)off[0];
  const double v[3] = {(double)off[1], (double)off[2], (double)off[3]};
  const double J[9] = {q0, v[2], -v[1], -v[2], q0, v[0], v[1], -v[0], q0};
  const double turning[9] = {
      0, (double)own[2], -(double)own[1], -(double)own[2], 0, (double)own[0], (double)own[1], -(double)own[0], 0};
  if (control_gyro_at(R, &node, a) != FB_OK) {
    return loop_no_model(s, c, "gyro");
  }
  if (a->gyro_body != a->body && fb_vec3_dot(node.angular_rate, node.angular_rate) > 0) {
    return loop_fail(s, c->line, "a gyro of another body than that of attitude", "has no linear model where it spins");
  }
  fb_quat_to_mat33(N, node.quat);
  fb_mat33_mul(M, R, N);
  for (int i = 0; i < 9 && there; i++) {
    const scene_output turn = loop_axis(SCENE_ROTATION, a->body, a->node, i % 3);
    const scene_output gyro = loop_axis(SCENE_GYRO, a->gyro_body, a->gyro_node, i % 3);
    loops.C[loops.n * (signal + i / 3) + state + i % 3] += by * J[i];
    loops.C[loops.n * (signal + 3 + i / 3) + state + i % 3] += turning[i];
    there = loop_add_sensor(s, signal + i / 3, &turn, by * J[i], W) &&
            loop_add_sensor(s, signal + 3 + i / 3, &turn, turning[i], W) &&
            loop_add_sensor(s, signal + 3 + i / 3, &gyro, (double)M[i], W);
  }
  return there ? 0 : loop_no_model(s, c, "attitude");
}

/* B of the commands, C and D of what controllers add up. W: what a command does at the inputs of the model. */
static int loop_connect(scene *s, const double *W)
{
  const fb_linear *const linear = &plant.linear;
  for (int l = 0; l < loops.n_command; l++) {
    for (int p = 0; p < linear->n_in; p++) {
      for (int i = 0; i < loops.n; i++) {
        loops.B[loops.n * l + i] += W[loops.n_command * p + l] * (double)linear->B[linear->n_in * i + p];
      }
    }
  }
  for (int k = 0; k < s->n_control; k++) {
    const scene_control *const c = &s->control[k];
    for (int j = 0; j < c->n_sensor; j++) {
      const scene_output *const o = &s->output[c->sensor[j].output];
      for (int i = 0; i < c->n_signal; i++) {
        if (!loop_add_sensor(s, loops.signal[k] + i, o, c->sensor[j].gain[i], W)) {
          return loop_no_model(s, c, o->label);
        }
      }
    }
    if (c->attitude.is && loop_add_attitude(s, k, W)) {
      return 1;
    }
  }
  return 0;
}

/* The linear model with all commands and sensors. */
static int loop_linearize(scene *s, int line)
{
  static int in[SCENE_ACTS][3], parts[SCENE_ACTS];
  static double by[SCENE_ACTS][3], W[FB_MAX_PORTS * SCENE_COMMANDS];
  fb_status status = plant_begin(s);
  loops.n_command = loops.n_signal = 0;
  for (int k = 0; k < s->n_control; k++) {
    loops.command[k] = loops.n_command;
    loops.signal[k] = loops.n_signal;
    loops.n_command += s->control[k].n_command;
    loops.n_signal += s->control[k].n_signal;
  }
  if (status == FB_OK && loop_find_ports(s, in, by, parts)) {
    return 1;
  }
  status = status ? status : plant_solve(s);
  if (status != FB_OK) {
    return scene_fail_at(s, line, "margins: no linear model about the start: %s%s", fb_status_string(status),
                         refusal_detail(status));
  }
  loops.n = plant.linear.n;
  if (!loop_plant_room((size_t)loops.n, (size_t)loops.n_command, (size_t)loops.n_signal)) {
    return loop_fail(s, line, "the scene", "wants more memory than there is");
  }
  memset(W, 0, sizeof W);
  for (int k = 0; k < s->n_act; k++) {
    for (int l = 0; l < loops.n_command; l++) {
      for (int i = 0; i < parts[k]; i++) {
        W[loops.n_command * in[k][i] + l] += by[k][i] * seen_gain(s, k, l);
      }
    }
  }
  return loop_connect(s, W);
}

/* The plant over one sample, and where everything stands in the state. */
static int loop_discretize(scene *s, int line)
{
  static fb_real scale[FB_MAX_LINEAR];
  const double T = s->control[0].sample;
  const int n = loops.n;
  double *const G = (double *)loop_room((size_t)(n * CONTROL_SIGNALS), sizeof *G);
  int well = G != NULL;
  loops.order = n;
  loops.sample = T;
  memcpy(loops.A, plant.linear.A, (size_t)(n * n) * sizeof *loops.A);
  fbi_balance(loops.A, scale, n);
  for (int i = 0; i < n * loops.n_command; i++) {
    loops.B[i] /= (double)scale[i % n];
  }
  for (int i = 0; i < n * loops.n_signal; i++) {
    loops.C[i] *= (double)scale[i % n];
  }
  for (int k = 0; k < s->n_control && well; k++) {
    const scene_control *const c = &s->control[k];
    const double late = ceil(c->delay / T * (1 - 1e-9)), part = late * T - c->delay;
    double *const B = loops.B + n * loops.command[k], *const before = loops.before + n * loops.command[k];
    loops.late[k] = (int)late;
    loops.part[k] = part > 1e-9 * T ? part : 0;
    well = loop_hold(loops.F, G, loops.A, B, n, c->n_command, T - loops.part[k]) &&
           loop_hold(loops.F, loops.after + n * loops.command[k], loops.A, B, n, c->n_command, loops.part[k]);
    for (int i = 0; i < n * c->n_command && well; i++) {
      before[i] = 0;
      for (int j = 0; j < n; j++) {
        before[i] += loops.F[n * (i % n) + j] * G[n * (i / n) + j];
      }
    }
    for (int l = 0; l < c->n_command; l++) {
      loops.history[loops.command[k] + l] = loops.order;
      loops.order += loops.late[k] + 1;
    }
    for (int b = 0; b < c->n_block; b++) {
      loops.memory[k][b] = loops.order;
      loops.order += control_states(&c->block[b]);
    }
  }
  well = well && loop_hold(loops.F, G, loops.A, loops.B, n, s->control[0].n_command, T);
  return well && loop_sample_room((size_t)loops.order)
             ? 0
             : loop_fail(s, line, "the scene", "wants more memory than there is");
}

/* Loops that are cut: their matrices, and the points where the response may want them. */
static int loop_open(scene *s, int k, loop_cut *cut)
{
  loop_matrix(s, cut->H, cut);
  memcpy(loops.M, cut->H, (size_t)(loops.order * loops.order) * sizeof *loops.M);
  if (!loop_poles(loops.M)) {
    return loop_fail(s, s->control[k].line, s->control[k].name, "has a loop whose poles are not found");
  }
  loop_reduce(cut);
  loop_grid();
  return 0;
}

/* All commands of a controller cut at once: the least return difference. */
static int loop_open_all(scene *s, int k, double radius)
{
  loops.all.n = s->control[k].n_command;
  for (int i = 0; i < loops.all.n; i++) {
    loops.all.command[i] = loops.command[k] + i;
  }
  if (loop_open(s, k, &loops.all)) {
    return 1;
  }
  loops.difference[k] = loop_least_difference(&loops.difference_at[k]);
  if (radius > 1 + 1e-6) {
    loops.difference[k] = 0;
  }
  return 0;
}

/* A loop, from its cut: its response over frequency, and its margins unless the closed loops are unstable. */
static int loop_open_one(scene *s, int k, int command, double radius)
{
  loop_margins *const m = &loops.margins[command];
  loops.one.n = 1;
  loops.one.command[0] = command;
  if (loop_open(s, k, &loops.one)) {
    return 1;
  }
  for (int i = 0; i < loops.n_point; i++) {
    loops.point[i].L = loop_gain(loops.point[i].omega);
  }
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
  double radius = 0;
  loop_matrix(s, loops.M, NULL);
  if (!loop_poles(loops.M)) {
    return -1;
  }
  for (int i = 0; i < loops.order; i++) {
    radius = fmax(radius, hypot((double)loops.re[i], (double)loops.im[i]));
  }
  return radius;
}

/* A command's loop by its name: of the controller, with a number where it has several. */
static const char *loop_name(char name[TEXT_NAME + 16], const scene *s, int command)
{
  int k = s->n_control - 1;
  while (loops.command[k] > command) {
    k--;
  }
  if (s->control[k].n_command == 1) {
    snprintf(name, TEXT_NAME + 16, "%s", s->control[k].name);
  } else {
    snprintf(name, TEXT_NAME + 16, "%s.%d", s->control[k].name, command - loops.command[k] + 1);
  }
  return name;
}

/* The response of the loop that was cut last: Bode and Nyquist, and the return difference of its controller. */
static void loop_write(const scene *s, FILE *csv, int command)
{
  loop_margins *const m = &loops.margins[command];
  const double at[3] = {m->gain_at, m->reduction_at, m->phase_at};
  char name[TEXT_NAME + 16];
  double turn = 0, last = 0;
  loop_name(name, s, command);
  for (int p = 0; p < loops.n_point; p++) {
    const double complex L = loops.point[p].L;
    const double angle = carg(L);
    turn += p == 0 ? (angle > 0 ? -2 * function_pi : 0) : -2 * function_pi * round((angle - last) / (2 * function_pi));
    last = angle;
    for (int i = 0; i < 3; i++) {
      m->shown[i] = loops.point[p].omega <= at[i] ? (angle + turn) * 180 / function_pi : m->shown[i];
    }
    fprintf(csv, "%s,%.12g,%.12g,%.12g,%.12g,%.12g,%.12g\n", name, loops.point[p].omega, 20 * log10(cabs(L)),
            (angle + turn) * 180 / function_pi, creal(L), cimag(L), loop_difference(loops.point[p].omega));
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

static void loop_tell(const scene *s, FILE *talk, int command)
{
  const loop_margins *const m = &loops.margins[command];
  char name[TEXT_NAME + 16];
  loop_name(name, s, command);
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

/* What the return difference guarantees where a controller has several commands. */
static void loop_tell_all(const scene *s, FILE *talk, int k)
{
  const double a = loops.difference[k];
  if (!(a > 0) || s->control[k].n_command == 1) {
    return;
  }
  fprintf(
      talk,
      "%s, all of its commands at once: return difference at least %.4g, at %.4g rad/s; stable for gains from %.4g ",
      s->control[k].name, a, loops.difference_at[k], 1 / (1 + a));
  if (a < 1) {
    fprintf(talk, "to %.4g, or phases", 1 / (1 - a));
  } else {
    fputs("on, or phases", talk);
  }
  fprintf(talk, " within %.3g deg of each\n", 360 / function_pi * asin(fmin(1, 0.5 * a)));
}

/* Of one of its loops, or the least of all of them. */
static double loop_measured(const scene *s, const scene_measure *m)
{
  const int first = loops.command[m->output], n = s->control[m->output].n_command;
  double value[SCENE_RETURN_DIFFERENCE - SCENE_GAIN_MARGIN + 1] = {HUGE_VAL, 0, function_pi,
                                                                   HUGE_VAL, 0, loops.difference[m->output]};
  for (int k = m->command > 0 ? m->command - 1 : 0; k < (m->command > 0 ? m->command : n); k++) {
    const loop_margins *const of = &loops.margins[first + k];
    value[0] = fmin(value[0], of->gain);
    value[1] = fmax(value[1], of->reduction);
    value[2] = fmin(value[2], of->phase);
    value[3] = fmin(value[3], of->delay);
    value[4] = of->radius;
  }
  return value[m->kind - SCENE_GAIN_MARGIN];
}

/* Each controller: all its loops at once, then each of them; their response to a file, and what they say to `talk`. */
static int loop_open_each(scene *s, double radius, FILE *csv, FILE *talk)
{
  for (int k = 0; k < s->n_control; k++) {
    if (loop_open_all(s, k, radius)) {
      return 1;
    }
    for (int i = loops.command[k]; i < loops.command[k] + s->control[k].n_command; i++) {
      if (loop_open_one(s, k, i, radius)) {
        return 1;
      }
      if (csv) {
        loop_smooth();
        loop_write(s, csv, i);
      }
      if (talk) {
        loop_tell(s, talk, i);
      }
    }
    if (talk) {
      loop_tell_all(s, talk, k);
    }
  }
  return 0;
}

/* Margins of all loops, and their response to a file that is named. */
static int loop_measure(scene *s, int line, const char *name, FILE *talk)
{
  FILE *csv = NULL;
  double radius;
  int failed;
  if (loop_check(s, line) || loop_linearize(s, line) || loop_discretize(s, line)) {
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
    fputs("loop,omega [rad/s],gain [dB],phase [deg],re [-],im [-],return_difference [-]\n", csv);
  }
  failed = loop_open_each(s, radius, csv, talk);
  if (csv && failed) {
    output_drop(csv, name);
  } else if (csv && !output_is_whole(csv, name)) {
    failed = scene_fail(s, "cannot write %s: %s%s", name, strerror(errno), output_left(name));
  }
  for (int k = 0; k < s->n_measure && !failed; k++) {
    if (s->measure[k].kind >= SCENE_GAIN_MARGIN) {
      s->measured[k] = loop_measured(s, &s->measure[k]);
    }
  }
  return failed;
}

/* Margins of all loops about the start, and their response to a file, as far as they are asked for. */
static int scene_measure_margins(scene *s, const char *name, FILE *talk)
{
  int line = 0, failed;
  for (int k = 0; k < s->n_measure; k++) {
    line = line == 0 && s->measure[k].kind >= SCENE_GAIN_MARGIN ? s->measure[k].line : line;
  }
  if (line == 0 && !name) {
    return 0;
  }
  failed = loop_measure(s, line, name, talk);
  loop_release();
  return failed;
}
#endif
