/* control.h - blocks of a sampled controller, from lines of text: signals v_k go through one block after the other at each
   instant k T of a sample of T [s]. Include text.h and function.h first.

   Every linear block is  w_k = C x_k + D v_k,  x_{k+1} = A x_k + B v_k:  the same numbers make its steps and its
   response at a frequency. A block of one signal acts on each of several alike.

   pid KP KI KD [TAU]        w_k = KP v_k + KI s_k + KD d_k
                             s_k = s_{k-1} + T/2 (v_k + v_{k-1})                  integral, bilinear (Tustin)
                             d_k = (TAU d_{k-1} + v_k - v_{k-1}) / (TAU + T)      s/(TAU s + 1), backward difference
                             s_0 = T/2 v_0, d_0 = 0. A bilinear rate would have a pole at z = -1 where TAU is 0.
   notch HZ ZERO POLE        (s^2 + 2 ZERO w s + w^2) / (s^2 + 2 POLE w s + w^2), w = 2 pi HZ
   lowpass HZ ZETA           w^2 / (s^2 + 2 ZETA w s + w^2)
                             both bilinear, s = w / tan(w T/2) (z - 1)/(z + 1), which is exact at w (prewarped)
   state_space N A B C D     the sampled block itself: A by rows
   state_space .. end, state_space file NAME
                             of all signals at once, N states: the table [A B; C D], its rows on lines of their own or in a
                             file. It has as many columns as states and signals that come in, and may let others out
   saturate U                w_k = v_k, at least -U and at most U. The integral of a pid before it rests while it
                             limits, as long as the integral would drive it further; blocks between the two keep the sign
   rate_limit R              w_k = w_{k-1} + v_k - w_{k-1}, this difference at most R T in size; w_{-1} = 0
   dead_band U               w_k = 0 where |v_k| <= U, beyond it v_k less U in size
   table V W V W ..          linear between its points, constant beyond them; V ascend
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

#define CONTROL_ORDER 6       /* of a block of one signal */
#define CONTROL_SIGNALS 24    /* of a controller */
#define CONTROL_NUMBERS 65536 /* of all matrices */

typedef enum control_kind {
  CONTROL_PID, /* linear, of each signal: */
  CONTROL_FILTER,
  CONTROL_STATE_SPACE,
  CONTROL_LAW, /* linear, of all signals: */
  CONTROL_MATRICES,
  CONTROL_SATURATE, /* linear while small: */
  CONTROL_QUANTIZE,
  CONTROL_RATE_LIMIT,
  CONTROL_DEAD_BAND,
  CONTROL_TABLE,
  CONTROL_THRUSTER, /* not linear: */
  CONTROL_PULSE
} control_kind;

typedef struct control_block {
  control_kind kind;
  int line, in, out; /* signals */
  int n;             /* order: states of a signal, or of all */
  int at;            /* where it remembers */
  double A[CONTROL_ORDER * CONTROL_ORDER], B[CONTROL_ORDER], C[CONTROL_ORDER], D;
  int first;                   /* of all signals: where A, B, C, D are among the numbers */
  double size, on, off, least; /* of what is not linear: U, R, Q or LEVEL; of thrusters */
  function curve;              /* of a table, over v */
} control_block;

typedef struct control_numbers {
  int n;
  double x[CONTROL_NUMBERS];
} control_numbers;

typedef struct control_reading { /* what lines of blocks are read with */
  double sample;
  int signals; /* that come in */
  const char *path;
  function_tables *tables;
  control_numbers *numbers;
} control_reading;

/* What a block remembers: its states, then those of the sample before; of a thruster the sign of what is on and since when
   [s]; of a rate limit what went out. */
static int control_room(const control_block *b)
{
  return b->kind == CONTROL_LAW || b->kind == CONTROL_MATRICES ? 2 * b->n
         : b->kind <= CONTROL_STATE_SPACE                      ? 2 * b->n * b->in
         : b->kind == CONTROL_THRUSTER                         ? 2 * b->in
         : b->kind == CONTROL_RATE_LIMIT                       ? b->in
                                                               : 0;
}

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

/* A row of [A B; C D]; the columns of the first one say how many states there are. */
static void control_add_row(text_file *t, control_numbers *numbers, int *columns)
{
  int k = 0;
  for (; text_more(t); k++) {
    const double x = text_number(t, "a number of [A B; C D]");
    if (numbers->n == CONTROL_NUMBERS) {
      text_fail(t, "more than %d numbers of matrices", CONTROL_NUMBERS);
      return;
    }
    numbers->x[numbers->n++] = x;
  }
  if (*columns > 0 && k != *columns) {
    text_fail(t, "this row of [A B; C D] has %d numbers, the first one has %d", k, *columns);
  }
  *columns = k;
}

/* The rows of a file, one on a line. */
static int control_read_rows(text_file *t, const control_reading *r, int *columns)
{
  char path[512];
  text_file other;
  int rows = 0;
  const char *const name = text_word(t);
  if (!name) {
    text_fail(t, "the name of a file is missing");
    return 0;
  }
  text_beside(path, r->path, name);
  if (!text_try(&other, t->program, path)) {
    text_fail(t, "%s: %s", path, strerror(errno));
    return 0;
  }
  other.message = t->message;
  other.fault = t->fault;
  other.table = 1;
  for (; text_line(&other); rows++) {
    control_add_row(&other, r->numbers, columns);
  }
  t->failed |= other.failed;
  text_close(&other);
  return rows;
}

/* Sorts the rows of [A B; C D] into A, B, C and D. */
static void control_sort_rows(double *x, int n, int in, int out)
{
  static double sorted[CONTROL_NUMBERS];
  double *to = sorted;
  const int corner[4][4] = {{0, n, 0, n}, {0, n, n, n + in}, {n, n + out, 0, n}, {n, n + out, n, n + in}};
  for (int k = 0; k < 4; k++) {
    for (int i = corner[k][0]; i < corner[k][1]; i++) {
      for (int j = corner[k][2]; j < corner[k][3]; j++) {
        *to++ = x[(n + in) * i + j];
      }
    }
  }
  memcpy(x, sorted, (size_t)(to - sorted) * sizeof *x);
}

/* state_space, its rows, end; or state_space file NAME */
static void control_read_matrices(text_file *t, control_block *b, const control_reading *r, int file)
{
  int columns = 0, rows = 0;
  b->kind = CONTROL_MATRICES;
  b->first = r->numbers->n;
  if (file) {
    rows = control_read_rows(t, r, &columns);
  } else {
    text_end_of_line(t);
    text_begin(t, "state_space", "");
    for (; text_within(t); rows++) {
      control_add_row(t, r->numbers, &columns);
    }
  }
  b->n = columns - r->signals;
  b->out = rows - b->n;
  if (!t->failed && (b->n < 0 || b->out < 1 || b->out > CONTROL_SIGNALS)) {
    text_fail(t,
              "[A B; C D] has %d rows of %d numbers: of %d signals that come in it wants %d states, and a row for each "
              "and for each of 1 to %d signals that go out",
              rows, columns, r->signals, b->n > 0 ? b->n : 0, CONTROL_SIGNALS);
  }
  if (!t->failed) {
    control_sort_rows(r->numbers->x + b->first, b->n, b->in, b->out);
  }
}

/* table V W V W .., or table file NAME COLUMN COLUMN */
static void control_read_table(text_file *t, control_block *b, const control_reading *r)
{
  const int file = text_take(t, "file");
  b->curve.first = r->tables->n;
  b->curve.kind = FUNCTION_TABLE;
  if (file) {
    function_read_columns(t, &b->curve, r->tables, r->path);
    return;
  }
  do {
    const double v = text_number(t, "value that comes in");
    if (!t->failed && b->curve.n > 0 && !(v > r->tables->row[r->tables->n - 1].t)) {
      text_fail(t, "the values of a table must ascend: %g comes behind %g", v, r->tables->row[r->tables->n - 1].t);
    }
    function_add_row(t, &b->curve, r->tables, v, text_number(t, "value that goes out"));
  } while (text_more(t));
}

static const struct control_word {
  const char *word;
  control_kind kind;
} control_words[] = {{"pid", CONTROL_PID},
                     {"notch", CONTROL_FILTER},
                     {"lowpass", CONTROL_FILTER},
                     {"state_space", CONTROL_STATE_SPACE},
                     {"saturate", CONTROL_SATURATE},
                     {"quantize", CONTROL_QUANTIZE},
                     {"rate_limit", CONTROL_RATE_LIMIT},
                     {"dead_band", CONTROL_DEAD_BAND},
                     {"table", CONTROL_TABLE},
                     {"thruster", CONTROL_THRUSTER},
                     {"pulse", CONTROL_PULSE}};

/* What a word makes; NULL: it is no block. */
static const struct control_word *control_word_of(const char *word)
{
  for (int k = 0; k < (int)(sizeof control_words / sizeof *control_words); k++) {
    if (strcmp(control_words[k].word, word) == 0) {
      return &control_words[k];
    }
  }
  return NULL;
}

/* The block of that word: 0 if it is none. */
static int control_read_block(text_file *t, control_block *b, const char *word, const control_reading *r)
{
  const struct control_word *const is = control_word_of(word);
  int file;
  if (!is) {
    return 0;
  }
  memset(b, 0, sizeof *b);
  b->kind = is->kind;
  b->line = t->line;
  b->in = b->out = r->signals;
  switch (b->kind) {
  case CONTROL_PID:
    control_read_pid(t, b, r->sample);
    break;
  case CONTROL_FILTER:
    control_read_filter(t, b, r->sample, strcmp(word, "notch") == 0);
    break;
  case CONTROL_STATE_SPACE:
    file = text_take(t, "file");
    if (file || !text_more(t)) {
      control_read_matrices(t, b, r, file);
    } else {
      control_read_state_space(t, b);
    }
    break;
  case CONTROL_TABLE:
    control_read_table(t, b, r);
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
  return b->kind <= CONTROL_MATRICES;
}

/* ---- steps */

static double control_round(double x, double size)
{
  return size > 0 ? size * round(x / size) : x;
}

/* w = C x + D v, next = A x + B v, of so many states and signals. */
static void control_product(const double *A, const double *B, const double *C, const double *D, int n, int in, int out,
                            double *w, double *next, const double *x, const double *v)
{
  for (int i = 0; i < n + out; i++) {
    const double *const a = i < n ? A + n * i : C + n * (i - n), *const d = i < n ? B + in * i : D + in * (i - n);
    double sum = 0;
    for (int j = 0; j < in; j++) {
      sum += d[j] * v[j];
    }
    for (int j = 0; j < n; j++) {
      sum += a[j] * x[j];
    }
    *(i < n ? next + i : w + (i - n)) = sum;
  }
}

/* A linear block: of all signals at once, or of each. next: states, as x. */
static void control_linear(const control_block *b, const control_numbers *numbers, double *w, double *next,
                           const double *x, const double *v)
{
  if (b->kind >= CONTROL_LAW) {
    const int n = b->n;
    const double *const A = numbers->x + b->first, *const B = A + n * n, *const C = B + n * b->in;
    control_product(A, B, C, C + b->out * n, n, b->in, b->out, w, next, x, v);
    return;
  }
  for (int k = 0; k < b->in; k++) {
    control_product(b->A, b->B, b->C, &b->D, b->n, 1, 1, w + k, next + b->n * k, x + b->n * k, v + k);
  }
}

/* States of a linear block. */
static int control_states(const control_block *b)
{
  return !control_is_linear(b) ? 0 : b->kind >= CONTROL_LAW ? b->n : b->n * b->in;
}

/* On or off: the level, with its sign. m: the sign, and since when. */
static double control_fire(const control_block *b, double m[2], double v, double sample)
{
  if (fabs(m[0]) > 0 && v * m[0] <= b->off && m[1] >= b->least - 1e-9 * sample) {
    m[0] = 0;
  }
  if (!(fabs(m[0]) > 0)) {
    m[0] = v >= b->on ? 1 : v <= -b->on ? -1 : 0;
    m[1] = 0;
  }
  m[1] += sample;
  return m[0] * b->size;
}

/* Integrals before block k rest that drive signal i, which is limited there at v, further. */
static void control_rest(const control_block *b, const control_numbers *numbers, double *memory, int k, int i, double v)
{
  for (k--; k >= 0 && b[k].kind != CONTROL_MATRICES; k--) {
    double *const x = memory + b[k].at, *const before = x + control_states(&b[k]);
    if (b[k].kind == CONTROL_PID && (x[2 * i] - before[2 * i]) * b[k].C[0] * v > 0) {
      x[2 * i] = before[2 * i];
    }
    if (b[k].kind == CONTROL_LAW) {
      const double *const C = numbers->x + b[k].first + b[k].n * (b[k].n + b[k].in) + b[k].n * i;
      for (int j = 0; j < b[k].n; j++) {
        x[j] = C[j] * (x[j] - before[j]) * v > 0 ? before[j] : x[j];
      }
      return;
    }
  }
}

/* A block of one signal that is not linear. width: for how long [s] the result acts. */
static double control_bend(const control_block *b, const function_tables *tables, double *m, double v, double sample,
                           double *width)
{
  const double part = fmin(1, fabs(v) / b->size), most = b->size * sample;
  switch (b->kind) {
  case CONTROL_SATURATE:
    return fmax(-b->size, fmin(b->size, v));
  case CONTROL_QUANTIZE:
    return control_round(v, b->size);
  case CONTROL_RATE_LIMIT:
    *m += fmax(-most, fmin(most, v - *m));
    return *m;
  case CONTROL_DEAD_BAND:
    return copysign(fmax(0, fabs(v) - b->size), v);
  case CONTROL_TABLE:
    return function_table(&b->curve, tables, v, v).value;
  case CONTROL_THRUSTER:
    return control_fire(b, m, v, sample);
  default: /* a pulse */
    *width = part < 1 ? part * sample : HUGE_VAL;
    return part > 0 && part * sample >= b->least ? copysign(b->size, v) : 0;
  }
}

static void control_swap(double *a, double *b, int n)
{
  for (int i = 0; i < n; i++) {
    const double kept = a[i];
    a[i] = b[i];
    b[i] = kept;
  }
}

/* All blocks at an instant, signals v in place. memory: where their `at` begin; limited: what they command is limited
   behind them. width[i] [s]: for how long a command acts, HUGE_VAL: until the next. */
static void control_step(const control_block *b, const control_numbers *numbers, const function_tables *tables,
                         double *memory, int n, double v[CONTROL_SIGNALS], double sample, int first, int limited,
                         double width[CONTROL_SIGNALS])
{
  for (int i = 0; i < CONTROL_SIGNALS; i++) {
    width[i] = HUGE_VAL;
  }
  for (int k = 0; k < n; k++) {
    double w[CONTROL_SIGNALS], *const m = memory + b[k].at;
    const int states = control_states(&b[k]), per = b[k].kind == CONTROL_THRUSTER ? 2 : 1;
    for (int i = 0; i < b[k].in && first && b[k].kind == CONTROL_PID; i++) {
      m[2 * i + 1] = -v[i];
    }
    if (control_is_linear(&b[k])) {
      control_linear(&b[k], numbers, w, m + states, m, v);
      control_swap(m, m + states, states);
    }
    for (int i = 0; i < b[k].in && !control_is_linear(&b[k]); i++) {
      w[i] = control_bend(&b[k], tables, m + per * i, v[i], sample, &width[i]);
      if (b[k].kind == CONTROL_SATURATE && fabs(v[i]) > b[k].size) {
        control_rest(b, numbers, memory, k, i, v[i]);
      }
    }
    memcpy(v, w, (size_t)b[k].out * sizeof *v);
  }
  for (int i = 0; i < b[n - 1].out && limited; i++) {
    control_rest(b, numbers, memory, n, i, v[i]);
  }
}
#endif
