/* fmu_core.h - what FMI 2 and 3 have in common: values by reference, modes of an instance, communication steps, saved
   states. It knows nothing of what it simulates: that is a plant (fmu_body.h, fmu_scene.h), included before, with

     fmu_plant, fmu_plant_state                    the model with its scratch; all that changes
     fmu_plant_clear(p)                            zeros, where they matter
     fmu_plant_open(p, resources, text)            is the model what was exported?
     fmu_plant_token(p)                            of the model
     fmu_plant_variables(p, list)                  how many, in the order of their references
     fmu_plant_default(v, element)                 value before anything is set
     fmu_plant_node(v)                             name of the node of a variable that has one
     fmu_plant_start(p, state, values, text)       the state that the parameters describe
     fmu_plant_step(p, state, values, from, length, text)
     fmu_plant_until(p, state)                     [s] to the next event that is not due yet, HUGE_VAL: there is none
     fmu_plant_is_due(p, state)                    is an event due?
     fmu_plant_has_events(p)                       has it any?
     fmu_plant_happen(p, state, values, text)      what is due happens, which the next step does otherwise
     fmu_plant_outputs(p, state, values, text)     fills in the outputs
     fmu_plant_instant(p, h, state, values, text)  [s] short beside all that moves; FMU_ERROR: it has no derivatives
     fmu_plant_ahead(p, state, values, h, text)    one accurate step of h: nothing that happens at instants happens
     fmu_plant_prepare(p, values, text)            what has to be built for the parameters
     fmu_plant_spans(p, span, state)               the parts of a state that this model has, where it is prepared: how many

   and fmu_host, what the interface wants to know of its importer.

   An answer is the status of FMI 2 and 3; where it is not FMU_OK, text says why and nothing has changed. */
#ifndef FMU_CORE_H
#define FMU_CORE_H
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

typedef enum fmu_mode { FMU_MADE, FMU_INITIALIZING, FMU_STEPPING, FMU_EVENT, FMU_ENDED } fmu_mode;

typedef struct fmu_head {   /* what changes in every instance */
  int mode, started, fresh; /* is the state that of the parameters or later; are the outputs those of the state? */
  int stop_defined;
  double time, stop;
} fmu_head;

typedef struct fmu_saved {
  unsigned size, token, check; /* [bytes] with what follows; of the FMU; of what stands behind `zero` */
  unsigned zero;
  fmu_head head; /* then the values and, where it is started, the parts of the state of the plant */
} fmu_saved;
#define FMU_SAVED_MOST (sizeof(fmu_saved) + FMU_MAX_VALUES * sizeof(double) + sizeof(fmu_plant_state))

typedef struct fmu_memory_calls { /* as those of FMI 2; not used with FMU_STATIC */
  void *(*take)(size_t n, size_t size);
  void (*give)(void *block);
} fmu_memory_calls;

typedef struct fmu {
  fmu_memory_calls calls;
  fmu_host host;
  fmu_head now;
  double value[FMU_MAX_VALUES], value_before[FMU_MAX_VALUES];
  fmu_plant_state state, state_before;
  fmu_variable variable[FMU_MAX_VARIABLES];
  int n_variable, n_value;
  short owner[FMU_MAX_VALUES]; /* variable of a value reference */
  fmu_text text;
  int events, early; /* does the importer use event mode; may a step end before its end? */
  int stopped;       /* the last one did, at an event */
  fmu_plant plant;   /* last */
} fmu;

static inline void fmu_clear(fmu *f)
{
  clear_memory(f, offsetof(fmu, plant));
  fmu_plant_clear(&f->plant);
}

static fmu_answer fmu_refuse(fmu *f, fmu_answer answer, const char *format, ...)
{
  va_list list;
  va_start(list, format);
  vsnprintf(f->text, sizeof f->text, format, list);
  va_end(list);
  return answer;
}

static fmu_values fmu_all(fmu *f)
{
  const fmu_values all = {f->variable, f->n_variable, f->value};
  return all;
}

/* "tip.force[2]" into name. */
static void fmu_element_name(char name[FMU_NAME], const fmu_variable *v, int element)
{
  fmu_name(name, v, fmu_plant_node(v));
  if (v->count > 1) {
    snprintf(name + strlen(name), 16, "[%d]", element + 1);
  }
}

/* As instantiated; time begins at 0. */
static void fmu_reset(fmu *f)
{
  memset(&f->now, 0, sizeof f->now);
  memset(f->value, 0, sizeof f->value);
  for (int k = 0; k < f->n_variable; k++) {
    const fmu_variable *const v = &f->variable[k];
    for (int i = 0; i < v->count; i++) {
      f->value[v->first + i] = fmu_plant_default(v, i);
    }
  }
}

/* The variables of the plant that is open, as instantiated. */
static void fmu_list(fmu *f)
{
  f->n_variable = fmu_plant_variables(&f->plant, f->variable);
  for (int k = 0; k < f->n_variable; k++) {
    for (int i = 0; i < f->variable[k].count; i++) {
      f->owner[f->n_value++] = (short)k;
    }
  }
  fmu_reset(f);
}

/* f: of zeros. token: what the importer has read; resources: the folder. */
static fmu_answer fmu_init(fmu *f, const char *token, const char *resources)
{
  const fmu_answer answer = fmu_plant_open(&f->plant, resources, f->text);
  if (answer != FMU_OK) {
    return answer;
  }
  if (!token || strcmp(token, fmu_plant_token(&f->plant)) != 0) {
    return fmu_refuse(f, FMU_ERROR, "the token of the model description is %.60s, that of the program %s",
                      token ? token : "missing", fmu_plant_token(&f->plant));
  }
  fmu_list(f);
  return FMU_OK;
}

/* ---- modes */

static fmu_answer fmu_wants(fmu *f, int mode, const char *call)
{
  static const char *const when[] = {"before initialization", "in initialization", "after initialization",
                                     "in event mode", "after the end"};
  return f->now.mode == mode
             ? FMU_OK
             : fmu_refuse(f, FMU_ERROR, "%s is called %s; it belongs %s", call, when[f->now.mode], when[mode]);
}

static fmu_answer fmu_begin(fmu *f, double start, int stop_defined, double stop)
{
  const fmu_answer answer = fmu_wants(f, FMU_MADE, "the start");
  if (answer != FMU_OK) {
    return answer;
  }
  if (!isfinite(start) || (stop_defined && !(isfinite(stop) && stop >= start))) {
    return fmu_refuse(f, FMU_ERROR, "from %g s to %g s: no times of an experiment", start, stop);
  }
  f->value[0] = f->now.time = start;
  f->now.stop_defined = stop_defined;
  f->now.stop = stop_defined ? stop : start;
  return FMU_OK;
}

/* The state that the parameters describe, where it is not there yet. */
static fmu_answer fmu_started(fmu *f)
{
  const fmu_values all = fmu_all(f);
  fmu_answer answer = FMU_OK;
  if (!f->now.started) {
    answer = fmu_plant_start(&f->plant, &f->state, &all, f->text);
    f->now.started = answer == FMU_OK;
    f->now.fresh = 0;
  }
  return answer;
}

static fmu_answer fmu_enter(fmu *f)
{
  const fmu_answer answer = fmu_wants(f, FMU_MADE, "the begin of initialization");
  f->now.mode = answer == FMU_OK ? (int)FMU_INITIALIZING : f->now.mode;
  return answer;
}

static fmu_answer fmu_exit(fmu *f)
{
  fmu_answer answer = fmu_wants(f, FMU_INITIALIZING, "the end of initialization");
  answer = answer ? answer : fmu_started(f);
  f->now.mode = answer != FMU_OK ? f->now.mode : f->events ? (int)FMU_EVENT : (int)FMU_STEPPING;
  return answer;
}

static fmu_answer fmu_end(fmu *f)
{
  const fmu_answer answer = f->now.mode == FMU_EVENT ? FMU_OK : fmu_wants(f, FMU_STEPPING, "the end");
  f->now.mode = answer == FMU_OK ? (int)FMU_ENDED : f->now.mode;
  return answer;
}

/* ---- values */

/* The variable of a reference; NULL after a refusal. whole: is an enumeration, which is no real number, wanted? */
static const fmu_variable *fmu_find(fmu *f, unsigned reference, int whole)
{
  const fmu_variable *v = reference < (unsigned)f->n_value ? &f->variable[f->owner[reference]] : NULL;
  if (!v) {
    fmu_refuse(f, FMU_ERROR, "there is no value reference %u; the last one is %d", reference, f->n_value - 1);
  } else if (fmu_is_choice(v->kind) != whole) {
    char name[FMU_NAME];
    fmu_element_name(name, v, 0);
    fmu_refuse(f, FMU_ERROR, "%s is %s", name, whole ? "a real number" : "an enumeration");
    v = NULL;
  }
  return v;
}

/* Has it gone through initialization? */
static int fmu_is_running(const fmu *f)
{
  return f->now.mode != FMU_MADE && f->now.mode != FMU_INITIALIZING;
}

/* May this number be that of a variable? */
static fmu_answer fmu_accepts(fmu *f, const fmu_variable *v, int element, double x)
{
  const fmu_role role = fmu_rows[v->kind].role;
  char name[FMU_NAME];
  fmu_element_name(name, v, element);
  if (role != FMU_INPUT && role != FMU_PARAMETER) {
    return fmu_refuse(f, FMU_ERROR, "%s is computed, it cannot be set", name);
  }
  if (role == FMU_PARAMETER && fmu_is_running(f)) {
    return fmu_refuse(f, FMU_ERROR, "%s is a parameter, it cannot be set after initialization", name);
  }
  if (!(fabs(x) <= FB_HUGE)) {
    return fmu_refuse(f, FMU_ERROR, "%s: %g is no finite number of at most %g", name, x, (double)FB_HUGE);
  }
  if (v->kind == FMU_STEP && !(x > 0)) {
    return fmu_refuse(f, FMU_ERROR, "%s is above 0: %g", name, x);
  }
  if ((v->kind == FMU_DAMPING || v->kind == FMU_SCENE_STEP) && !(x >= 0)) {
    return fmu_refuse(f, FMU_ERROR, "%s is at least 0: %g", name, x);
  }
  if (v->kind == FMU_SCENE_EARLY && !(fabs(x) <= 0 || fabs(x - 1) <= 0)) {
    return fmu_refuse(f, FMU_ERROR, "%s is 0 or 1: %g", name, x);
  }
  if (fmu_is_factor(v->kind) && !(x >= FMU_FACTOR_LEAST && x <= FMU_FACTOR_MOST)) {
    return fmu_refuse(f, FMU_ERROR, "%s is %g to %g: %g", name, FMU_FACTOR_LEAST, FMU_FACTOR_MOST, x);
  }
  if (fmu_is_choice(v->kind) && !(x >= 1 && x <= fmu_choices(v->kind))) {
    return fmu_refuse(f, FMU_ERROR, "%s is 1 to %d: %g", name, fmu_choices(v->kind), x);
  }
  return FMU_OK;
}

/* Outputs as state and inputs have them. */
static fmu_answer fmu_refresh(fmu *f)
{
  const fmu_values all = fmu_all(f);
  fmu_answer answer = FMU_OK;
  if (!f->now.fresh || !f->now.started) {
    answer = fmu_started(f);
    answer = answer ? answer : fmu_plant_outputs(&f->plant, &f->state, &all, f->text);
    f->now.fresh = answer == FMU_OK;
  }
  return answer;
}

typedef enum fmu_shape { FMU_NUMBERS, FMU_VECTORS } fmu_shape; /* what a reference names: FMI 2 and 3 */

/* What reference[k] names, and how many numbers that is; NULL after a refusal. */
static const fmu_variable *fmu_named(fmu *f, int *count, unsigned reference, fmu_shape shape)
{
  const fmu_variable *const v = fmu_find(f, reference, 0);
  if (v && shape == FMU_VECTORS && reference != (unsigned)v->first) {
    fmu_refuse(f, FMU_ERROR, "there is no value reference %u; %d is that of the vector around it", reference, v->first);
    return NULL;
  }
  *count = v && shape == FMU_VECTORS ? v->count : 1;
  return v;
}

/* Do the references name n_value numbers, and may they become these (value NULL: nothing becomes)? */
static fmu_answer fmu_list_check(fmu *f, const unsigned *reference, size_t n, const double *value, size_t n_value,
                                 fmu_shape shape)
{
  size_t at = 0;
  for (size_t k = 0; k < n; k++) {
    int count;
    const fmu_variable *const v = fmu_named(f, &count, reference[k], shape);
    if (!v) {
      return FMU_ERROR;
    }
    for (int i = 0; i < count && value && at + (size_t)i < n_value; i++) {
      const fmu_answer answer = fmu_accepts(f, v, (int)reference[k] - v->first + i, value[at + (size_t)i]);
      if (answer != FMU_OK) {
        return answer;
      }
    }
    at += (size_t)count;
  }
  return at == n_value
             ? FMU_OK
             : fmu_refuse(f, FMU_ERROR, "these variables are %u numbers, not %u", (unsigned)at, (unsigned)n_value);
}

/* Sets all of them or none. */
static fmu_answer fmu_set(fmu *f, const unsigned *reference, size_t n, const double *value, size_t n_value,
                          fmu_shape shape)
{
  fmu_answer answer;
  if (n > 0 && (!reference || !value)) {
    return fmu_refuse(f, FMU_ERROR, "a list of references or values is missing");
  }
  answer = fmu_list_check(f, reference, n, value, n_value, shape);
  for (size_t k = 0, at = 0; k < n && answer == FMU_OK; k++) {
    int count;
    (void)fmu_named(f, &count, reference[k], shape);
    memcpy(f->value + reference[k], value + at, (size_t)count * sizeof *value);
    f->now.fresh = 0;
    f->now.started = f->now.started && fmu_is_running(f); /* before, an input may make the state as parameters do */
    at += (size_t)count;
  }
  return answer;
}

static fmu_answer fmu_get(fmu *f, const unsigned *reference, size_t n, double *value, size_t n_value, fmu_shape shape)
{
  fmu_answer answer;
  if (n > 0 && (!reference || !value)) {
    return fmu_refuse(f, FMU_ERROR, "a list of references or values is missing");
  }
  answer = fmu_list_check(f, reference, n, NULL, n_value, shape);
  for (size_t k = 0, at = 0; k < n && answer == FMU_OK; k++) {
    int count;
    const fmu_variable *const v = fmu_named(f, &count, reference[k], shape);
    answer = v && fmu_rows[v->kind].role == FMU_OUTPUT ? fmu_refresh(f) : FMU_OK;
    if (answer == FMU_OK) {
      memcpy(value + at, f->value + reference[k], (size_t)count * sizeof *value);
    }
    at += (size_t)count;
  }
  return answer;
}

/* An enumeration */
static fmu_answer fmu_set_choice(fmu *f, unsigned reference, double x)
{
  const fmu_variable *const v = fmu_find(f, reference, 1);
  const fmu_answer answer = v ? fmu_accepts(f, v, 0, x) : FMU_ERROR;
  if (answer == FMU_OK) {
    f->value[reference] = x;
    f->now.fresh = f->now.started = 0;
  }
  return answer;
}

static fmu_answer fmu_get_choice(fmu *f, unsigned reference, int *x)
{
  if (!fmu_find(f, reference, 1)) {
    return FMU_ERROR;
  }
  *x = (int)f->value[reference];
  return FMU_OK;
}

/* ---- steps */

static fmu_answer fmu_step_check(fmu *f, double from, double length)
{
  const double scale = FMU_SAME * (fabs(f->now.time) + fabs(length));
  if (!(length > 0) || !isfinite(length)) {
    return fmu_refuse(f, FMU_ERROR, "a communication step is above 0 and finite: %g s", length);
  }
  if (length < 100 * DBL_EPSILON * fabs(f->now.time)) {
    return fmu_refuse(f, FMU_ERROR, "a communication step of %g s, which a clock at %.12g s does not resolve", length,
                      f->now.time);
  }
  if (!(fabs(from - f->now.time) <= scale)) {
    return fmu_refuse(f, FMU_ERROR, "a step from %.12g s, while the time is %.12g s", from, f->now.time);
  }
  if (f->now.stop_defined && from + length > f->now.stop + FMU_SAME * (fabs(f->now.stop) + length)) {
    return fmu_refuse(f, FMU_ERROR, "a step from %.12g s to %.12g s, beyond the stop time %.12g s", from, from + length,
                      f->now.stop);
  }
  return FMU_OK;
}

static fmu_answer fmu_prepare(fmu *f)
{
  const fmu_values all = fmu_all(f);
  return fmu_plant_prepare(&f->plant, &all, f->text);
}

/* Of states of the plant that is prepared. */
static void fmu_copy_state(fmu *f, fmu_plant_state *to, fmu_plant_state *from)
{
  fmu_span target[FMU_MAX_SPANS], source[FMU_MAX_SPANS];
  const int n = fmu_plant_spans(&f->plant, target, to);
  fmu_plant_spans(&f->plant, source, from);
  for (int k = 0; k < n; k++) {
    memcpy(target[k].at, source[k].at, source[k].bytes);
  }
}

/* May a step end at an event? FMI 2 has a parameter for it. */
static int fmu_is_early(const fmu *f)
{
  int early = f->early;
  for (int k = 0; k < f->n_variable; k++) {
    early |= f->variable[k].kind == FMU_SCENE_EARLY && f->value[f->variable[k].first] > 0;
  }
  return early;
}

/* A communication step. FMU_DISCARD: the motion cannot be stepped so; the state is as before. f->stopped: it went up to
   an event, the time of which it is. */
static fmu_answer fmu_step(fmu *f, double from, double length)
{
  const fmu_values all = fmu_all(f);
  double until;
  fmu_answer answer = fmu_wants(f, FMU_STEPPING, "a step");
  answer = answer ? answer : fmu_step_check(f, from, length);
  answer = answer ? answer : fmu_prepare(f);
  if (answer != FMU_OK) {
    return answer;
  }
  until = fmu_is_early(f) ? fmu_plant_until(&f->plant, &f->state) : HUGE_VAL;
  f->stopped = until < length * (1 - FMU_SAME);
  length = f->stopped ? until : length;
  fmu_copy_state(f, &f->state_before, &f->state);
  answer = fmu_plant_step(&f->plant, &f->state, &all, from, length, f->text);
  if (answer != FMU_OK) {
    fmu_copy_state(f, &f->state, &f->state_before);
    return answer;
  }
  f->value[0] = f->now.time = from + length;
  f->now.fresh = 0;
  return FMU_OK;
}

/* ---- events */

/* From the mode of steps to that of events, or back. */
static inline fmu_answer fmu_change(fmu *f, int from, int to, const char *call)
{
  const fmu_answer answer =
      f->events ? fmu_wants(f, from, call) : fmu_refuse(f, FMU_ERROR, "event mode was not asked for, or has no events");
  f->now.mode = answer == FMU_OK ? to : f->now.mode;
  return answer;
}

/* What is due happens; *next: the time of the next event, HUGE_VAL: none. */
static inline fmu_answer fmu_happen(fmu *f, double *next)
{
  const fmu_values all = fmu_all(f);
  fmu_answer answer = fmu_wants(f, FMU_EVENT, "an event");
  answer = answer ? answer : fmu_prepare(f);
  if (answer != FMU_OK) {
    return answer;
  }
  fmu_copy_state(f, &f->state_before, &f->state);
  answer = fmu_plant_happen(&f->plant, &f->state, &all, f->text);
  if (answer != FMU_OK) {
    fmu_copy_state(f, &f->state, &f->state_before);
    return answer;
  }
  f->now.fresh = 0;
  *next = f->now.time + fmu_plant_until(&f->plant, &f->state);
  return FMU_OK;
}

/* ---- derivatives */

/* Are these numbers of outputs, or inputs? */
static fmu_answer fmu_are(fmu *f, const unsigned *reference, int n, fmu_role role)
{
  for (int k = 0; k < n; k++) {
    const fmu_variable *const v = fmu_find(f, reference[k], 0);
    if (!v) {
      return FMU_ERROR;
    }
    if (fmu_rows[v->kind].role != role) {
      char name[FMU_NAME];
      fmu_element_name(name, v, (int)reference[k] - v->first);
      return fmu_refuse(f, FMU_ERROR, "derivatives are those of outputs, by time or inputs: %s is no %s", name,
                        role == FMU_OUTPUT ? "output" : "input");
    }
  }
  return FMU_OK;
}

static fmu_answer fmu_are_finite(fmu *f, const double *x, int n)
{
  for (int k = 0; k < n; k++) {
    if (!isfinite(x[k])) {
      return fmu_refuse(f, FMU_ERROR, "a derivative along what is not finite");
    }
  }
  return FMU_OK;
}

/* d unknown = (partial derivative of outputs by inputs at the present state) d known, for n_known numbers. Outputs are
   linear in forces and gravity: the difference of two of any distance is exact but for rounding, and less of that the
   larger the distance. */
static fmu_answer fmu_slope(fmu *f, double *change, const unsigned *unknown, int n_unknown, const unsigned *known,
                            const double *by, int n_known)
{
  static const double reach = 1024;
  fmu_answer answer = fmu_are(f, unknown, n_unknown, FMU_OUTPUT);
  answer = answer ? answer : fmu_are(f, known, n_known, FMU_INPUT);
  answer = answer ? answer : fmu_are_finite(f, by, n_known);
  answer = answer ? answer : fmu_started(f);
  if (answer != FMU_OK) {
    return answer;
  }
  memcpy(f->value_before, f->value, sizeof f->value);
  for (int side = -1; side <= 1 && answer == FMU_OK; side += 2) {
    memcpy(f->value, f->value_before, sizeof f->value);
    for (int k = 0; k < n_known; k++) {
      f->value[known[k]] += side * reach * by[k];
    }
    f->now.fresh = 0;
    answer = fmu_refresh(f);
    for (int k = 0; k < n_unknown && answer == FMU_OK; k++) {
      const double x = f->value[unknown[k]];
      change[k] = side < 0 ? x : (x - change[k]) / (2 * reach);
    }
  }
  memcpy(f->value, f->value_before, sizeof f->value);
  f->now.fresh = 0;
  return answer;
}

/* d known = (that derivative, transposed) d unknown: column by column. */
static inline fmu_answer fmu_adjoint(fmu *f, double *change, const unsigned *unknown, const double *by, int n_unknown,
                                     const unsigned *known, int n_known)
{
  static const double one = 1;
  double column[FMU_MAX_VALUES];
  fmu_answer answer = fmu_are_finite(f, by, n_unknown);
  for (int k = 0; k < n_known && answer == FMU_OK; k++) {
    double sum = 0;
    answer = fmu_slope(f, column, unknown, n_unknown, &known[k], &one, 1);
    for (int i = 0; i < n_unknown && answer == FMU_OK; i++) {
      sum += column[i] * by[i];
    }
    change[k] = sum;
  }
  return answer;
}

/* Derivatives of outputs by time, inputs held: of the polynomial through the outputs now and at four instants ahead,
   h apart, which a copy of the state goes to. Its error is h^4/5 times the fifth derivative. */
static fmu_answer fmu_rates(fmu *f, double *rate, const unsigned *reference, int n)
{
  static const double weight[] = {0, 48, -36, 16, -3};
  const fmu_values all = fmu_all(f);
  double now[FMU_MAX_VALUES], h = 0;
  fmu_answer answer = fmu_are(f, reference, n, FMU_OUTPUT);
  answer = answer ? answer : fmu_refresh(f);
  answer = answer ? answer : fmu_prepare(f);
  answer = answer ? answer : fmu_plant_instant(&f->plant, &h, &f->state, &all, f->text);
  if (answer != FMU_OK) {
    return answer;
  }
  memcpy(f->value_before, f->value, sizeof f->value);
  fmu_copy_state(f, &f->state_before, &f->state);
  for (int k = 0; k < n; k++) {
    now[k] = f->value[reference[k]];
    rate[k] = 0;
  }
  for (int ahead = 1; ahead < 5 && answer == FMU_OK; ahead++) {
    answer = fmu_plant_ahead(&f->plant, &f->state_before, &all, h, f->text);
    answer = answer ? answer : fmu_plant_outputs(&f->plant, &f->state_before, &all, f->text);
    for (int k = 0; k < n && answer == FMU_OK; k++) {
      rate[k] += weight[ahead] * (f->value[reference[k]] - now[k]) / (12 * h);
    }
  }
  memcpy(f->value, f->value_before, sizeof f->value);
  return answer;
}

/* ---- saved states */

/* Check word of many bytes, which costs a multiplication for four: states are saved often. */
static unsigned fmu_word(const void *from, size_t bytes)
{
  const unsigned char *const byte = (const unsigned char *)from;
  unsigned long long sum = 14695981039346656037u;
  for (size_t k = 0; k < bytes; k += sizeof(unsigned)) {
    unsigned word = 0;
    memcpy(&word, byte + k, bytes - k < sizeof word ? bytes - k : sizeof word);
    sum = (sum ^ word) * 1099511628211u;
  }
  return (unsigned)(sum >> 32 ^ sum);
}

static unsigned fmu_token_word(const fmu *f)
{
  const char *const token = fmu_plant_token(&f->plant);
  return fmu_word(token, strlen(token));
}

/* Check word of what is saved. */
static unsigned fmu_saved_word(const fmu_saved *saved)
{
  return fmu_word(&saved->head, saved->size - offsetof(fmu_saved, head));
}

/* Where values and state go to, or come from, and how many bytes with the head: a state that is saved. */
static size_t fmu_saved_parts(fmu *f, fmu_span *span, int *n)
{
  size_t bytes = sizeof(fmu_saved);
  const fmu_span values = {f->value, (size_t)f->n_value * sizeof(double)};
  span[0] = values;
  *n = 1 + (f->now.started ? fmu_plant_spans(&f->plant, span + 1, &f->state) : 0);
  for (int k = 0; k < *n; k++) {
    bytes += span[k].bytes;
  }
  return bytes;
}

/* to: of so many bytes as fmu_saved_parts says. */
static void fmu_save(const fmu *f, fmu_saved *to, const fmu_span *span, int n, size_t bytes)
{
  unsigned char *at = (unsigned char *)(to + 1);
  memset(to, 0, sizeof *to);
  to->size = (unsigned)bytes;
  to->token = fmu_token_word(f);
  to->head = f->now;
  for (int k = 0; k < n; k++) {
    memcpy(at, span[k].at, span[k].bytes);
    at += span[k].bytes;
  }
  to->check = fmu_saved_word(to);
}

/* Is it a state of this FMU, as it was saved? */
static fmu_answer fmu_saved_check(fmu *f, const fmu_saved *from)
{
  if (!from || from->token != fmu_token_word(f) || from->size < sizeof *from || from->size > FMU_SAVED_MOST) {
    return fmu_refuse(f, FMU_ERROR, "this is no state of this model, but of another one or nothing");
  }
  if (from->check != fmu_saved_word(from)) {
    return fmu_refuse(f, FMU_ERROR, "the saved state is damaged: its check word differs");
  }
  return FMU_OK;
}

/* The plant is built for the parameters of the state, where it is for others. */
static fmu_answer fmu_load(fmu *f, const fmu_saved *from)
{
  const fmu_head was = f->now;
  const size_t values = (size_t)f->n_value * sizeof(double);
  fmu_span span[FMU_MAX_SPANS + 1];
  const unsigned char *at = (const unsigned char *)(from + 1);
  size_t bytes = 0;
  int n = 0;
  fmu_answer answer = fmu_saved_check(f, from);
  if (answer != FMU_OK) {
    return answer;
  }
  memcpy(f->value_before, f->value, values);
  memcpy(f->value, at, values);
  f->now = from->head;
  answer = f->now.started ? fmu_prepare(f) : FMU_OK;
  bytes = answer == FMU_OK ? fmu_saved_parts(f, span, &n) : 0;
  if (answer == FMU_OK && bytes != from->size) {
    answer = fmu_refuse(f, FMU_ERROR, "a state of these parameters has %u bytes, not %u", (unsigned)bytes, from->size);
  }
  if (answer != FMU_OK) {
    memcpy(f->value, f->value_before, values);
    f->now = was;
    return answer;
  }
  for (int k = 0; k < n; k++) {
    memcpy(span[k].at, at, span[k].bytes);
    at += span[k].bytes;
  }
  return FMU_OK;
}
#endif
