/* fmu_core.h - what FMI 2 and 3 have in common: values by reference, modes of an instance, communication steps, saved
   states. It knows nothing of what it simulates: that is a plant (fmu_body.h, fmu_scene.h), included before, with

     fmu_plant, fmu_plant_state                    the model with its scratch; all that changes
     fmu_plant_open(p, resources, text)            is the model what was exported?
     fmu_plant_close(p)
     fmu_plant_token(p)                            of the model
     fmu_plant_variables(p, list)                  how many, in the order of their references
     fmu_plant_default(v, element)                 value before anything is set
     fmu_plant_node(v)                             name of the node of a variable that has one
     fmu_plant_start(p, state, values, text)       the state that the parameters describe
     fmu_plant_step(p, state, values, from, length, text)
     fmu_plant_outputs(p, state, values, text)     fills in the outputs
     fmu_plant_copy(to, from)                      states

   and fmu_host, what the interface wants to know of its importer.

   An answer is the status of FMI 2 and 3; where it is not FMU_OK, text says why and nothing has changed. */
#ifndef FMU_CORE_H
#define FMU_CORE_H
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

typedef enum fmu_mode { FMU_MADE, FMU_INITIALIZING, FMU_STEPPING, FMU_ENDED } fmu_mode;

typedef struct fmu_memory { /* all that changes, without pointers: assignment saves it */
  int mode, started, fresh; /* is state that of the parameters or later; are the outputs those of state? */
  int stop_defined;
  double time, stop;
  fmu_plant_state state;
  double value[FMU_MAX_VALUES];
} fmu_memory;

typedef struct fmu_saved {
  unsigned size, token, check; /* of this struct; of the FMU; of what follows */
  unsigned zero;
  fmu_memory memory;
} fmu_saved;

typedef struct fmu_memory_calls { /* as those of FMI 2; not used with FMU_STATIC */
  void *(*take)(size_t n, size_t size);
  void (*give)(void *block);
} fmu_memory_calls;

typedef struct fmu {
  fmu_memory_calls calls;
  fmu_host host;
  fmu_memory now, before;
  fmu_plant plant;
  fmu_variable variable[FMU_MAX_VARIABLES];
  int n_variable, n_value;
  short owner[FMU_MAX_VALUES]; /* variable of a value reference */
  fmu_text text;
} fmu;

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
  const fmu_values all = {f->variable, f->n_variable, f->now.value};
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
  for (int k = 0; k < f->n_variable; k++) {
    const fmu_variable *const v = &f->variable[k];
    for (int i = 0; i < v->count; i++) {
      f->now.value[v->first + i] = fmu_plant_default(v, i);
    }
  }
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
  f->n_variable = fmu_plant_variables(&f->plant, f->variable);
  for (int k = 0; k < f->n_variable; k++) {
    for (int i = 0; i < f->variable[k].count; i++) {
      f->owner[f->n_value++] = (short)k;
    }
  }
  fmu_reset(f);
  return FMU_OK;
}

/* ---- modes */

static fmu_answer fmu_wants(fmu *f, int mode, const char *call)
{
  static const char *const when[] = {"before initialization", "in initialization", "after initialization",
                                     "after the end"};
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
  f->now.value[0] = f->now.time = start;
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
    answer = fmu_plant_start(&f->plant, &f->now.state, &all, f->text);
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
  f->now.mode = answer == FMU_OK ? (int)FMU_STEPPING : f->now.mode;
  return answer;
}

static fmu_answer fmu_end(fmu *f)
{
  const fmu_answer answer = fmu_wants(f, FMU_STEPPING, "the end");
  f->now.mode = answer == FMU_OK ? (int)FMU_ENDED : f->now.mode;
  return answer;
}

/* ---- values */

/* The variable of a reference; NULL after a refusal. whole: is the integrator, which is no real number, wanted? */
static const fmu_variable *fmu_find(fmu *f, unsigned reference, int whole)
{
  const fmu_variable *v = reference < (unsigned)f->n_value ? &f->variable[f->owner[reference]] : NULL;
  if (!v) {
    fmu_refuse(f, FMU_ERROR, "there is no value reference %u; the last one is %d", reference, f->n_value - 1);
  } else if ((v->kind == FMU_INTEGRATOR) != whole) {
    char name[FMU_NAME];
    fmu_element_name(name, v, 0);
    fmu_refuse(f, FMU_ERROR, "%s is %s", name, whole ? "a real number" : "an enumeration");
    v = NULL;
  }
  return v;
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
  if (role == FMU_PARAMETER && f->now.mode != FMU_MADE && f->now.mode != FMU_INITIALIZING) {
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
  if (v->kind == FMU_INTEGRATOR && !(x >= 1 && x <= (double)FB_INTEGRATOR_COUNT)) {
    return fmu_refuse(f, FMU_ERROR, "%s is 1 to %d: %g", name, (int)FB_INTEGRATOR_COUNT, x);
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
    answer = answer ? answer : fmu_plant_outputs(&f->plant, &f->now.state, &all, f->text);
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
    const fmu_variable *const v = fmu_named(f, &count, reference[k], shape);
    memcpy(f->now.value + reference[k], value + at, (size_t)count * sizeof *value);
    f->now.fresh = 0;
    f->now.started = f->now.started && v && fmu_rows[v->kind].role != FMU_PARAMETER;
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
      memcpy(value + at, f->now.value + reference[k], (size_t)count * sizeof *value);
    }
    at += (size_t)count;
  }
  return answer;
}

/* The integrator, which counts from 1. */
static fmu_answer fmu_set_choice(fmu *f, unsigned reference, double x)
{
  const fmu_variable *const v = fmu_find(f, reference, 1);
  const fmu_answer answer = v ? fmu_accepts(f, v, 0, x) : FMU_ERROR;
  if (answer == FMU_OK) {
    f->now.value[reference] = x;
    f->now.fresh = f->now.started = 0;
  }
  return answer;
}

static fmu_answer fmu_get_choice(fmu *f, unsigned reference, int *x)
{
  if (!fmu_find(f, reference, 1)) {
    return FMU_ERROR;
  }
  *x = (int)f->now.value[reference];
  return FMU_OK;
}

/* ---- steps */

static fmu_answer fmu_step_check(fmu *f, double from, double length)
{
  const double scale = FMU_SAME * (fabs(f->now.time) + fabs(length));
  if (!(length > 0) || !isfinite(length)) {
    return fmu_refuse(f, FMU_ERROR, "a communication step is above 0 and finite: %g s", length);
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

/* A communication step. FMU_DISCARD: the motion cannot be stepped so; the state is as before. */
static fmu_answer fmu_step(fmu *f, double from, double length)
{
  const fmu_values all = fmu_all(f);
  fmu_answer answer = fmu_wants(f, FMU_STEPPING, "a step");
  answer = answer ? answer : fmu_step_check(f, from, length);
  if (answer != FMU_OK) {
    return answer;
  }
  fmu_plant_copy(&f->before.state, &f->now.state);
  answer = fmu_plant_step(&f->plant, &f->now.state, &all, from, length, f->text);
  if (answer != FMU_OK) {
    fmu_plant_copy(&f->now.state, &f->before.state);
    return answer;
  }
  f->now.value[0] = f->now.time = from + length;
  f->now.fresh = 0;
  return FMU_OK;
}

/* ---- derivatives */

/* d unknown = (partial derivative of outputs by inputs at the present state) d known, for n_known numbers. Outputs are
   linear in forces and gravity: the difference of two of any distance is exact but for rounding, and less of that the
   larger the distance. */
static fmu_answer fmu_slope(fmu *f, double *change, const unsigned *unknown, int n_unknown, const unsigned *known,
                            const double *by, int n_known)
{
  static const double reach = 1024;
  fmu_answer answer = FMU_OK;
  for (int k = 0; k < n_unknown + n_known && answer == FMU_OK; k++) {
    const unsigned reference = k < n_unknown ? unknown[k] : known[k - n_unknown];
    const fmu_variable *const v = fmu_find(f, reference, 0);
    if (!v) {
      answer = FMU_ERROR;
    } else if (fmu_rows[v->kind].role != (k < n_unknown ? FMU_OUTPUT : FMU_INPUT)) {
      char name[FMU_NAME];
      fmu_element_name(name, v, (int)reference - v->first);
      answer = fmu_refuse(f, FMU_ERROR, "derivatives are those of outputs by inputs: %s is no %s", name,
                          k < n_unknown ? "output" : "input");
    } else if (k >= n_unknown && !isfinite(by[k - n_unknown])) {
      answer = fmu_refuse(f, FMU_ERROR, "a derivative along what is not finite");
    }
  }
  answer = answer ? answer : fmu_started(f);
  if (answer != FMU_OK) {
    return answer;
  }
  f->before = f->now;
  for (int side = -1; side <= 1 && answer == FMU_OK; side += 2) {
    memcpy(f->now.value, f->before.value, sizeof f->now.value);
    for (int k = 0; k < n_known; k++) {
      f->now.value[known[k]] += side * reach * by[k];
    }
    f->now.fresh = 0;
    answer = fmu_refresh(f);
    for (int k = 0; k < n_unknown && answer == FMU_OK; k++) {
      const double x = f->now.value[unknown[k]];
      change[k] = side < 0 ? x : (x - change[k]) / (2 * reach);
    }
  }
  f->now = f->before;
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

static void fmu_save(const fmu *f, fmu_saved *to)
{
  memset(to, 0, sizeof *to);
  to->size = (unsigned)sizeof *to;
  to->token = fmu_token_word(f);
  memcpy(&to->memory, &f->now, sizeof to->memory);
  to->check = fmu_word(&to->memory, sizeof to->memory);
}

static fmu_answer fmu_load(fmu *f, const fmu_saved *from)
{
  if (!from || from->size != sizeof *from || from->token != fmu_token_word(f)) {
    return fmu_refuse(f, FMU_ERROR, "this is no state of this FMU, but of another model or nothing");
  }
  if (from->check != fmu_word(&from->memory, sizeof from->memory)) {
    return fmu_refuse(f, FMU_ERROR, "the saved state is damaged: its check word differs");
  }
  memcpy(&f->now, &from->memory, sizeof f->now);
  return FMU_OK;
}

/* A saved state from bytes. */
static fmu_answer fmu_unpack(fmu *f, fmu_saved *to, const void *bytes, size_t n)
{
  fmu_saved saved;
  fmu_answer answer;
  if (!bytes || n != sizeof saved) {
    return fmu_refuse(f, FMU_ERROR, "a serialized state of this FMU has %u bytes, not %u", (unsigned)sizeof saved,
                      (unsigned)n);
  }
  memcpy(&saved, bytes, sizeof saved);
  f->before = f->now;
  answer = fmu_load(f, &saved);
  f->now = f->before;
  if (answer == FMU_OK) {
    *to = saved;
  }
  return answer;
}
#endif
