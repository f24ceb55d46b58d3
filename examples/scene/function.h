/* function.h - functions of time from a line of text: a word and its numbers, with two derivatives and the integral.
   Where a function jumps or bends, `side` says which piece counts: the middle of a step lies in one. Include text.h
   and csv.h first. scenes/README.md lists the words. */
#ifndef FUNCTION_H
#define FUNCTION_H

#define FUNCTION_ROWS 65536 /* of all tables */

typedef enum function_kind {
  FUNCTION_CONSTANT,
  FUNCTION_STEP,
  FUNCTION_RAMP,
  FUNCTION_SMOOTH,
  FUNCTION_VERSINE,
  FUNCTION_SINE,
  FUNCTION_PULSE,
  FUNCTION_TABLE,
  FUNCTION_FILE
} function_kind;

typedef struct function {
  function_kind kind;
  double a, t0, t1;    /* size; from, to [s] */
  double omega, phase; /* of a sine */
  int first, n;        /* rows of a table */
  /* to its value, from outside: an input of an FMU, and its rate since then; 0 in a file */
  double added, added_rate, added_from;
} function;

typedef struct function_row {
  double t, value, sum; /* sum: integral up to here */
} function_row;

typedef struct function_tables {
  int n;
  function_row row[FUNCTION_ROWS];
} function_tables;

typedef struct function_value {
  double value, rate, acceleration, sum; /* sum: integral from 0 */
} function_value;

static const double function_pi = 3.14159265358979324;

/* Of a table: linear between rows, constant beyond them. */
static function_value function_table(const function *f, const function_tables *tables, double t, double side)
{
  const function_row *const row = tables->row + f->first;
  function_value out = {0, 0, 0, 0};
  int low = 0, high = f->n - 1;
  if (side < row[0].t || f->n == 1) {
    out.value = row[0].value;
    out.sum = row[0].value * (t - row[0].t);
    return out;
  }
  if (side >= row[high].t) {
    out.value = row[high].value;
    out.sum = row[high].sum + row[high].value * (t - row[high].t);
    return out;
  }
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    *(row[middle].t <= side ? &low : &high) = middle;
  }
  out.rate = (row[high].value - row[low].value) / (row[high].t - row[low].t);
  out.value = row[low].value + out.rate * (t - row[low].t);
  out.sum = row[low].sum + 0.5 * (row[low].value + out.value) * (t - row[low].t);
  return out;
}

/* Those that rise from t0 to t1, by the part x of the way; d is its duration. */
static function_value function_rise(const function *f, double x, double d)
{
  const double turn = 2 * function_pi, s = sin(turn * x), c = cos(turn * x);
  function_value out = {0, 0, 0, 0};
  if (f->kind == FUNCTION_RAMP) {
    out.value = x;
    out.rate = 1 / d;
    out.sum = 0.5 * x * x * d;
  } else if (f->kind == FUNCTION_SMOOTH) {
    out.value = x - s / turn;
    out.rate = (1 - c) / d;
    out.acceleration = turn * s / (d * d);
    out.sum = (0.5 * x * x + (c - 1) / (turn * turn)) * d;
  } else if (f->kind == FUNCTION_VERSINE) {
    out.value = 1 - c;
    out.rate = turn * s / d;
    out.acceleration = turn * turn * c / (d * d);
    out.sum = (x - s / turn) * d;
  } else { /* FUNCTION_PULSE */
    out.value = 1;
    out.sum = x * d;
  }
  return out;
}

static function_value function_add(function_value of, const function *f, double t)
{
  of.value += f->added + f->added_rate * (t - f->added_from);
  of.rate += f->added_rate;
  return of;
}

/* At t, of the piece that holds `side`. */
static function_value function_eval(const function *f, const function_tables *tables, double t, double side)
{
  const double d = f->t1 - f->t0;
  function_value out = {0, 0, 0, 0};
  if (f->kind == FUNCTION_TABLE) {
    return function_add(function_table(f, tables, t, side), f, t);
  }
  if (f->kind == FUNCTION_SINE) {
    const double s = sin(f->omega * t + f->phase), c = cos(f->omega * t + f->phase);
    out.value = s;
    out.rate = f->omega * c;
    out.acceleration = -f->omega * f->omega * s;
    out.sum = (cos(f->phase) - c) / f->omega;
  } else if (f->kind == FUNCTION_CONSTANT || f->kind == FUNCTION_STEP) {
    out.value = f->kind == FUNCTION_CONSTANT || side >= f->t0;
    out.sum = out.value * (t - f->t0);
  } else if (side >= f->t1) {
    const int stays = f->kind == FUNCTION_RAMP || f->kind == FUNCTION_SMOOTH;
    out.value = stays;
    out.sum = function_rise(f, 1, d).sum + stays * (t - f->t1);
  } else if (side >= f->t0) {
    out = function_rise(f, (t - f->t0) / d, d);
  }
  out.value *= f->a;
  out.rate *= f->a;
  out.acceleration *= f->a;
  out.sum *= f->a;
  return function_add(out, f, t);
}

/* [rad/s] of what it drives: 0 steady, HUGE_VAL a jump. */
static inline double function_frequency(const function *f, const function_tables *tables)
{
  double shortest = HUGE_VAL;
  switch (f->kind) {
  case FUNCTION_CONSTANT:
    return 0;
  case FUNCTION_SINE:
    return f->omega;
  case FUNCTION_RAMP:
    return function_pi / (f->t1 - f->t0);
  case FUNCTION_SMOOTH:
  case FUNCTION_VERSINE:
    return 2 * function_pi / (f->t1 - f->t0);
  case FUNCTION_TABLE:
    for (int k = 1; k < f->n; k++) {
      shortest = fmin(shortest, tables->row[f->first + k].t - tables->row[f->first + k - 1].t);
    }
    return f->n > 1 ? function_pi / (2 * shortest) : 0;
  default:
    return HUGE_VAL;
  }
}

/* Where it jumps or bends, and where it, or its rate, is at its most: how many, and into t. */
static int function_instants(const function *f, const function_tables *tables, double *t)
{
  static const int many[] = {[FUNCTION_STEP] = 1,    [FUNCTION_RAMP] = 2,   [FUNCTION_PULSE] = 2,
                             [FUNCTION_VERSINE] = 3, [FUNCTION_SMOOTH] = 3, [FUNCTION_FILE] = 0};
  const double shape[] = {f->t0, f->t1, 0.5 * (f->t0 + f->t1)};
  if (f->kind != FUNCTION_TABLE) {
    memcpy(t, shape, (size_t)many[f->kind] * sizeof *t);
    return many[f->kind];
  }
  for (int k = 0; k < f->n; k++) {
    t[k] = tables->row[f->first + k].t;
  }
  return f->n;
}

/* [rad/s] of the piece that holds `side`; 0: straight. */
static double function_pace(const function *f, double side)
{
  const int curved = f->kind == FUNCTION_SMOOTH || f->kind == FUNCTION_VERSINE;
  return f->kind == FUNCTION_SINE                  ? f->omega
         : curved && side >= f->t0 && side < f->t1 ? 2 * function_pi / (f->t1 - f->t0)
                                                   : 0;
}

static void function_add_row(text_file *t, function *f, function_tables *tables, double time, double value)
{
  function_row *const row = &tables->row[tables->n];
  if (tables->n == FUNCTION_ROWS) {
    text_fail(t, "more than %d rows of tables", FUNCTION_ROWS);
    return;
  }
  row->t = time;
  row->value = value;
  row->sum = value * time; /* of the first: it was constant before */
  if (f->n > 0) {
    row->sum = row[-1].sum + 0.5 * (row[-1].value + value) * (time - row[-1].t);
    if (!(time > row[-1].t)) {
      text_fail(t, "the times of a table must ascend");
    }
  }
  f->n++;
  tables->n++;
}

/* A table of two columns of a CSV file. */
static void function_read_file(text_file *t, function *f, function_tables *tables, const char *path,
                               const char *const column[2])
{
  static csv_file csv;
  int at[2];
  double x[2];
  if (csv_open(&csv, t, path, column, at, 2)) {
    while (csv_row(&csv, t, path, x, at, 2)) {
      function_add_row(t, f, tables, x[0], x[1]);
    }
    if (f->n == 0) {
      text_fail(t, "%s has no rows", path);
    }
  }
  if (csv.file) {
    fclose(csv.file);
  }
}

/* FILE TIME_COLUMN VALUE_COLUMN */
static void function_read_columns(text_file *t, function *f, function_tables *tables, const char *from)
{
  const char *const name = text_word(t);
  const char *const time = text_word(t), *const value = text_word(t);
  const char *const column[2] = {time, value};
  char path[512];
  if (!column[1]) {
    text_fail(t, "a file wants its name and two columns, time and value");
    return;
  }
  text_beside(path, from, name);
  f->kind = FUNCTION_TABLE;
  function_read_file(t, f, tables, path, column);
}

/* Reads the rest of the line; files are looked for beside `from`. */
static function function_read(text_file *t, function_tables *tables, const char *from)
{
  static const char *const kinds[] = {"constant", "step",  "ramp",  "smooth", "versine",
                                      "sine",     "pulse", "table", "file",   NULL};
  function f;
  memset(&f, 0, sizeof f);
  f.kind = (function_kind)text_choice(t, "a function", kinds);
  f.first = tables->n;
  if (f.kind == FUNCTION_TABLE) {
    do {
      const double time = text_number(t, "time");
      function_add_row(t, &f, tables, time, text_number(t, "value"));
    } while (text_more(t));
    return f;
  }
  if (f.kind == FUNCTION_FILE) {
    function_read_columns(t, &f, tables, from);
    return f;
  }
  f.a = text_number(t, "size");
  if (f.kind == FUNCTION_SINE) {
    f.omega = 2 * function_pi * text_number(t, "frequency in Hz");
    f.phase = text_more(t) ? text_degrees(t, "phase in degrees") : 0;
    if (!t->failed && !(f.omega > 0)) {
      text_fail(t, "the frequency of a sine must be greater than 0");
    }
  } else if (f.kind != FUNCTION_CONSTANT) {
    f.t0 = text_number(t, "time");
    f.t1 = f.kind == FUNCTION_STEP ? f.t0 : text_number(t, "time of the end");
    if (!t->failed && f.kind != FUNCTION_STEP && !(f.t1 > f.t0)) {
      text_fail(t, "a function must end after it begins");
    }
  }
  return f;
}
#endif
