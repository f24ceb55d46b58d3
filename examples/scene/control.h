/* control.h - blocks of a sampled controller, from lines of text: what comes in, v_k, goes through one after the other
   at each instant k T of a sample of T [s]. Include text.h first.

   Every linear block is  w_k = C x_k + D v_k,  x_{k+1} = A x_k + B v_k:  the same numbers make its steps and its
   response at a frequency.

   pid KP KI KD [TAU]        w_k = KP v_k + KI s_k + KD d_k
                             s_k = s_{k-1} + T/2 (v_k + v_{k-1})                  integral, bilinear (Tustin)
                             d_k = (TAU d_{k-1} + v_k - v_{k-1}) / (TAU + T)      s/(TAU s + 1), backward difference
                             s_0 = T/2 v_0, d_0 = 0. A bilinear rate would have a pole at z = -1 where TAU is 0.
   notch HZ ZERO POLE        (s^2 + 2 ZERO w s + w^2) / (s^2 + 2 POLE w s + w^2), w = 2 pi HZ
   lowpass HZ ZETA           w^2 / (s^2 + 2 ZETA w s + w^2)
                             both bilinear, s = w / tan(w T/2) (z - 1)/(z + 1), which is exact at w (prewarped)
   state_space N A B C D     the sampled block itself: A by rows
   saturate U                w_k = v_k, at least -U and at most U. The integral of a pid before it rests while it
                             limits, as long as the integral would drive it further; blocks between the two keep the sign
   quantize Q                w_k = Q round(v_k / Q), halves away from zero
   thruster LEVEL ON OFF [MINIMUM]
                             on with the sign of v_k where |v_k| >= ON, off where v_k times that sign <= OFF and it was
                             on for MINIMUM [s], in whole samples
   pulse LEVEL [MINIMUM]     LEVEL with the sign of v_k for |v_k| / LEVEL of the sample, at most all of it; nothing where
                             that is shorter than MINIMUM [s]

   At the start all x are zero, but for the memory of the rate: v_{-1} = v_0. */
#ifndef CONTROL_H
#define CONTROL_H
#include "../common/filter.h"

#define CONTROL_ORDER 6 /* of a block */

typedef enum control_kind {
  CONTROL_PID, /* linear: */
  CONTROL_FILTER,
  CONTROL_STATE_SPACE,
  CONTROL_SATURATE, /* linear while small: */
  CONTROL_QUANTIZE,
  CONTROL_THRUSTER, /* not linear: */
  CONTROL_PULSE
} control_kind;

typedef struct control_block {
  control_kind kind;
  int line, n; /* n: order */
  double A[CONTROL_ORDER * CONTROL_ORDER], B[CONTROL_ORDER], C[CONTROL_ORDER], D;
  double size, on, off, least; /* of what is not linear: U, Q or LEVEL; of thrusters */
} control_block;

typedef struct control_memory {                   /* of a block */
  double x[CONTROL_ORDER], before[CONTROL_ORDER]; /* before: of the sample before */
  int sign;                                       /* of a thruster that is on */
  double fired;                                   /* [s] it was on */
} control_memory;

/* ---- from text */

static double control_positive(text_file *t, const char *what)
{
  const double x = text_number(t, what);
  if (!t->failed && !(x > 0)) {
    text_fail(t, "%s must be greater than 0", what);
  }
  return x;
}

static double control_not_negative(text_file *t, const char *what)
{
  const double x = text_number(t, what);
  if (!t->failed && x < 0) {
    text_fail(t, "%s must not be negative", what);
  }
  return x;
}

static void control_read_pid(text_file *t, control_block *b, double sample)
{
  const double proportional = text_number(t, "proportional gain"), integral = text_number(t, "integral gain");
  const double rate = text_number(t, "differential gain");
  const double tau = text_more(t) ? control_not_negative(t, "time constant") : 0, keep = tau / (tau + sample);
  b->n = 2;
  b->A[0] = fabs(integral) > 0; /* else nothing is summed up */
  b->B[0] = fabs(integral) > 0 ? sample : 0;
  b->C[0] = integral;
  b->A[3] = keep; /* x_1 = TAU d_{k-1} - v_{k-1} */
  b->B[1] = keep - 1;
  b->C[1] = rate / (tau + sample);
  b->D = proportional + 0.5 * integral * sample + rate / (tau + sample);
}

static void control_read_filter(text_file *t, control_block *b, double sample, int notch)
{
  const double pi = 3.14159265358979324, w = 2 * pi * control_positive(t, "frequency in Hz");
  const double zero = notch ? control_not_negative(t, "damping of the zeros") : 0;
  const double pole = control_positive(t, notch ? "damping of the poles" : "damping");
  filter f;
  if (!t->failed && !(w * sample < pi)) {
    text_fail(t, "%g Hz is not below half the frequency of the samples, %g Hz", w / (2 * pi), 0.5 / sample);
  }
  filter_init(&f, notch ? 1 : 0, 2 * zero * w, w * w, 2 * pole * w, w * w, w, sample);
  b->n = 2;
  b->D = f.b[0];
  b->C[0] = 1;
  for (int i = 0; i < 2; i++) {
    b->A[2 * i] = -f.a[i];
    b->B[i] = f.b[i + 1] - f.a[i] * f.b[0];
  }
  b->A[1] = 1;
}

static void control_read_state_space(text_file *t, control_block *b)
{
  static fb_real re[CONTROL_ORDER], im[CONTROL_ORDER], X[2 * CONTROL_ORDER * CONTROL_ORDER];
  static fb_real A[CONTROL_ORDER * CONTROL_ORDER], work[4 * CONTROL_ORDER * CONTROL_ORDER];
  b->n = text_whole(t, "order", 1, CONTROL_ORDER);
  text_vector(t, "A", b->A, b->n * b->n);
  text_vector(t, "B", b->B, b->n);
  text_vector(t, "C", b->C, b->n);
  b->D = text_number(t, "D");
  for (int i = 0; i < b->n * b->n; i++) {
    A[i] = (fb_real)b->A[i];
  }
  if (!t->failed && fb_eig_general_solve(re, im, X, A, work, b->n) != FB_OK) {
    text_fail(t, "A has no eigenvalues that can be found");
  }
  for (int i = 0; i < b->n && !t->failed; i++) {
    const double size = hypot((double)re[i], (double)im[i]);
    if (size > 1 + 1e-6) {
      text_fail(t, "state_space is unstable: |z| = %.6g of a pole; 1 at most", size);
    }
  }
}

static void control_read_thruster(text_file *t, control_block *b)
{
  b->size = control_positive(t, "level");
  b->on = control_positive(t, "threshold of on");
  b->off = control_not_negative(t, "threshold of off");
  b->least = text_more(t) ? control_not_negative(t, "shortest pulse") : 0;
  if (!t->failed && b->off > b->on) {
    text_fail(t, "a thruster goes off at %g, above %g where it goes on", b->off, b->on);
  }
}

static const char *const control_words[] = {"pid",      "notch",    "lowpass", "state_space", "saturate",
                                            "quantize", "thruster", "pulse",   NULL};

/* The block of that word: 0 if it is none. */
static int control_read_block(text_file *t, control_block *b, const char *word, double sample)
{
  static const control_kind kinds[] = {CONTROL_PID,      CONTROL_FILTER,   CONTROL_FILTER,   CONTROL_STATE_SPACE,
                                       CONTROL_SATURATE, CONTROL_QUANTIZE, CONTROL_THRUSTER, CONTROL_PULSE};
  int k = 0;
  while (control_words[k] && strcmp(control_words[k], word) != 0) {
    k++;
  }
  if (!control_words[k]) {
    return 0;
  }
  memset(b, 0, sizeof *b);
  b->kind = kinds[k];
  b->line = t->line;
  switch (b->kind) {
  case CONTROL_PID:
    control_read_pid(t, b, sample);
    break;
  case CONTROL_FILTER:
    control_read_filter(t, b, sample, k == 1);
    break;
  case CONTROL_STATE_SPACE:
    control_read_state_space(t, b);
    break;
  case CONTROL_THRUSTER:
    control_read_thruster(t, b);
    break;
  case CONTROL_PULSE:
    b->size = control_positive(t, "level");
    b->least = text_more(t) ? control_not_negative(t, "shortest pulse") : 0;
    break;
  default:
    b->size = control_positive(t, word);
    break;
  }
  return 1;
}

static int control_is_linear(const control_block *b)
{
  return b->kind <= CONTROL_STATE_SPACE;
}

/* ---- steps */

static double control_round(double x, double size)
{
  return size > 0 ? size * round(x / size) : x;
}

/* w = C x + D v, next = A x + B v. */
static double control_linear(const control_block *b, double *next, const double *x, double v)
{
  double w = b->D * v;
  for (int i = 0; i < b->n; i++) {
    next[i] = b->B[i] * v;
    for (int j = 0; j < b->n; j++) {
      next[i] += b->A[b->n * i + j] * x[j];
    }
    w += b->C[i] * x[i];
  }
  return w;
}

/* On or off: the level, with its sign. */
static double control_fire(const control_block *b, control_memory *m, double v, double sample)
{
  if (m->sign != 0 && v * m->sign <= b->off && m->fired >= b->least - 1e-9 * sample) {
    m->sign = 0;
  }
  if (m->sign == 0) {
    m->sign = v >= b->on ? 1 : v <= -b->on ? -1 : 0;
    m->fired = 0;
  }
  m->fired += sample;
  return m->sign * b->size;
}

/* All blocks at an instant; the result is that of the last one. *width [s]: for how long it acts, HUGE_VAL: until the
   next. */
static double control_step(const control_block *b, control_memory *m, int n, double v, double sample, int first,
                           double *width)
{
  *width = HUGE_VAL;
  for (int k = 0; k < n; k++) {
    double next[CONTROL_ORDER] = {0}, w = v;
    if (control_is_linear(&b[k])) {
      if (first && b[k].kind == CONTROL_PID) {
        m[k].x[1] = -v;
      }
      w = control_linear(&b[k], next, m[k].x, v);
      memcpy(m[k].before, m[k].x, sizeof next);
      memcpy(m[k].x, next, sizeof next);
    } else if (b[k].kind == CONTROL_SATURATE) {
      w = fmax(-b[k].size, fmin(b[k].size, v));
      for (int i = 0; i < k && fabs(v) > b[k].size; i++) { /* integrals before it that drive it further rest */
        if (b[i].kind == CONTROL_PID && (m[i].x[0] - m[i].before[0]) * b[i].C[0] * v > 0) {
          m[i].x[0] = m[i].before[0];
        }
      }
    } else if (b[k].kind == CONTROL_QUANTIZE) {
      w = control_round(v, b[k].size);
    } else if (b[k].kind == CONTROL_THRUSTER) {
      w = control_fire(&b[k], &m[k], v, sample);
    } else {
      const double part = fmin(1, fabs(v) / b[k].size);
      w = part > 0 && part * sample >= b[k].least ? copysign(b[k].size, v) : 0;
      *width = part < 1 ? part * sample : HUGE_VAL;
    }
    v = w;
  }
  return v;
}
#endif
