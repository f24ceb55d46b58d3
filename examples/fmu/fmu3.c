/* fmu3.c - a flexible body or a scene as a co-simulation FMU of FMI 3.0: the interface around fmu_core.h. Written into each FMU
   beside its model (build/flexbeam fmu); compile this file alone, C99, with the math library. */
#include "fmu_config.h"
#ifndef FMU_LINKED /* with an object of the library, by make */
#define FLEXBEAM_STATIC
#endif
#define FMU_INTERFACE 3
#if FMU_OF_A_SCENE
#include "fmu_scene.h"
#else
#include "flexbeam.h"
#include "fmu_variables.h"
#include "fmu_model.h"
#include "fmu_body.h"
#endif
#include "fmi3Functions.h"

typedef struct fmu_host {
  fmi3LogMessageCallback logger;
  fmi3InstanceEnvironment environment;
} fmu_host;

#include "fmu_core.h"
#include "fmu_instance.h"

/* Tells why an answer is none that the importer wants. */
static fmi3Status told(fmu *f, fmu_answer answer)
{
  if (answer != FMU_OK && f->host.logger) {
    f->host.logger(f->host.environment, (fmi3Status)answer, "logStatusError", f->text);
  }
  return (fmi3Status)answer;
}

static fmi3Status refused(fmu *f, const char *why)
{
  return f ? told(f, fmu_refuse(f, FMU_ERROR, "%s", why)) : fmi3Error;
}

const char *fmi3GetVersion(void)
{
  return fmi3Version;
}

/* Errors are told in any case; there is nothing else to tell. */
fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t n, const fmi3String category[])
{
  (void)on, (void)n, (void)category;
  return instance ? fmi3OK : fmi3Error;
}

static fmi3Instance refused_kind(fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger)
{
  if (logger) {
    logger(environment, fmi3Error, "logStatusError", "this FMU is for co-simulation alone");
  }
  return NULL;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                          fmi3Boolean on, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback logger)
{
  (void)name, (void)token, (void)resources, (void)visible, (void)on;
  return refused_kind(environment, logger);
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean on, fmi3InstanceEnvironment environment,
                                               fmi3LogMessageCallback logger, fmi3ClockUpdateCallback clock,
                                               fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock)
{
  (void)name, (void)token, (void)resources, (void)visible, (void)on, (void)clock, (void)lock, (void)unlock;
  return refused_kind(environment, logger);
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean on, fmi3Boolean events, fmi3Boolean early,
                                         const fmi3ValueReference between[], size_t n_between,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
                                         fmi3IntermediateUpdateCallback update)
{
#if FMU_STATIC
  const fmu_memory_calls calls = {NULL, NULL};
#else
  const fmu_memory_calls calls = {calloc, free};
#endif
  fmu *const f = fmu_take(&calls);
  fmu_answer answer;
  (void)name, (void)visible, (void)on, (void)between, (void)update;
  if (!f) {
    if (logger) {
      logger(environment, fmi3Error, "logStatusError", "there is no memory for one more instance");
    }
    return NULL;
  }
  f->host.logger = logger;
  f->host.environment = environment;
  answer = fmu_init(f, token, resources ? resources : "");
  if (answer == FMU_OK && ((events && !fmu_plant_has_events(&f->plant)) || n_between > 0)) {
    answer =
        fmu_refuse(f, FMU_ERROR, "this FMU has no %s", events ? "events and no event mode" : "intermediate updates");
  }
  f->events = events;
  f->early = early;
  if (told(f, answer) != fmi3OK) {
    fmu_give(f);
    return NULL;
  }
  return f;
}

void fmi3FreeInstance(fmi3Instance instance)
{
  if (instance) {
    fmu_give((fmu *)instance);
  }
}

/* ---- modes */

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean tolerance_defined, fmi3Float64 tolerance,
                                       fmi3Float64 start, fmi3Boolean stop_defined, fmi3Float64 stop)
{
  fmu *const f = (fmu *)instance;
  fmu_answer answer = f ? fmu_begin(f, start, stop_defined, stop) : FMU_ERROR;
  (void)tolerance_defined, (void)tolerance;
  answer = answer ? answer : fmu_enter(f);
  return f ? told(f, answer) : fmi3Error;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
  fmu *const f = (fmu *)instance;
  return f ? told(f, fmu_exit(f)) : fmi3Error;
}

fmi3Status fmi3EnterEventMode(fmi3Instance instance)
{
  fmu *const f = (fmu *)instance;
  return f ? told(f, fmu_change(f, FMU_STEPPING, FMU_EVENT, "event mode")) : fmi3Error;
}

fmi3Status fmi3Terminate(fmi3Instance instance)
{
  fmu *const f = (fmu *)instance;
  return f ? told(f, fmu_end(f)) : fmi3Error;
}

fmi3Status fmi3Reset(fmi3Instance instance)
{
  if (instance) {
    fmu_reset((fmu *)instance);
  }
  return instance ? fmi3OK : fmi3Error;
}

/* ---- values */

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference reference[], size_t n, fmi3Float64 value[],
                          size_t n_value)
{
  fmu *const f = (fmu *)instance;
  return f ? told(f, fmu_get(f, reference, n, value, n_value, FMU_VECTORS)) : fmi3Error;
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference reference[], size_t n,
                          const fmi3Float64 value[], size_t n_value)
{
  fmu *const f = (fmu *)instance;
  return f ? told(f, fmu_set(f, reference, n, value, n_value, FMU_VECTORS)) : fmi3Error;
}

/* The integrator */
fmi3Status fmi3GetInt64(fmi3Instance instance, const fmi3ValueReference reference[], size_t n, fmi3Int64 value[],
                        size_t n_value)
{
  fmu *const f = (fmu *)instance;
  fmu_answer answer = FMU_OK;
  if (n != n_value || (n > 0 && (!reference || !value))) {
    return refused(f, "as many values as references, each of an enumeration");
  }
  for (size_t k = 0; k < n && answer == FMU_OK && f; k++) {
    int x = 0;
    answer = fmu_get_choice(f, reference[k], &x);
    value[k] = x;
    told(f, answer);
  }
  return f ? (fmi3Status)answer : fmi3Error;
}

fmi3Status fmi3SetInt64(fmi3Instance instance, const fmi3ValueReference reference[], size_t n, const fmi3Int64 value[],
                        size_t n_value)
{
  fmu *const f = (fmu *)instance;
  fmu_answer answer = FMU_OK;
  if (n != n_value || (n > 0 && (!reference || !value))) {
    return refused(f, "as many values as references, each of an enumeration");
  }
  for (size_t k = 0; k < n && answer == FMU_OK && f; k++) {
    answer = fmu_set_choice(f, reference[k], (double)value[k]);
    told(f, answer);
  }
  return f ? (fmi3Status)answer : fmi3Error;
}

/* Types of which there is no variable. */
#define NO_VARIABLES(name, type)                                                                                      \
  fmi3Status fmi3Get##name(fmi3Instance instance, const fmi3ValueReference reference[], size_t n, type value[],       \
                           size_t n_value)                                                                            \
  {                                                                                                                   \
    (void)reference, (void)value;                                                                                     \
    return n + n_value == 0 ? fmi3OK : refused((fmu *)instance, "there are no variables of type " #name);             \
  }                                                                                                                   \
  fmi3Status fmi3Set##name(fmi3Instance instance, const fmi3ValueReference reference[], size_t n, const type value[], \
                           size_t n_value)                                                                            \
  {                                                                                                                   \
    (void)reference, (void)value;                                                                                     \
    return n + n_value == 0 ? fmi3OK : refused((fmu *)instance, "there are no variables of type " #name);             \
  }
NO_VARIABLES(Float32, fmi3Float32)
NO_VARIABLES(Int8, fmi3Int8)
NO_VARIABLES(UInt8, fmi3UInt8)
NO_VARIABLES(Int16, fmi3Int16)
NO_VARIABLES(UInt16, fmi3UInt16)
NO_VARIABLES(Int32, fmi3Int32)
NO_VARIABLES(UInt32, fmi3UInt32)
NO_VARIABLES(UInt64, fmi3UInt64)
NO_VARIABLES(Boolean, fmi3Boolean)
NO_VARIABLES(String, fmi3String)
#undef NO_VARIABLES

fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference reference[], size_t n, size_t size[],
                         fmi3Binary value[], size_t n_value)
{
  (void)reference, (void)size, (void)value;
  return n + n_value == 0 ? fmi3OK : refused((fmu *)instance, "there are no variables of type Binary");
}

fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference reference[], size_t n, const size_t size[],
                         const fmi3Binary value[], size_t n_value)
{
  (void)reference, (void)size, (void)value;
  return n + n_value == 0 ? fmi3OK : refused((fmu *)instance, "there are no variables of type Binary");
}

/* ---- saved states */

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state)
{
  fmu *const f = (fmu *)instance;
  fmu_saved *saved = state ? (fmu_saved *)*state : NULL;
  fmu_answer answer;
  if (!state) {
    return refused(f, "a place for the state is missing");
  }
  answer = f ? fmu_keep(f, &saved) : FMU_ERROR;
  if (answer == FMU_OK) {
    *state = saved;
  }
  return f ? told(f, answer) : fmi3Error;
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state)
{
  fmu *const f = (fmu *)instance;
  return f ? told(f, fmu_load(f, (const fmu_saved *)state)) : fmi3Error;
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state)
{
  if (instance && state && *state) {
    fmu_give_saved((fmu *)instance, (fmu_saved *)*state);
    *state = NULL;
  }
  return instance ? fmi3OK : fmi3Error;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, size_t *size)
{
  if (!instance || !state || !size) {
    return refused((fmu *)instance, "the size of a state wants a state and a place");
  }
  *size = ((const fmu_saved *)state)->size;
  return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
  if (!instance || !state || !bytes || size < ((const fmu_saved *)state)->size) {
    return refused((fmu *)instance,
                   "a serialized state wants a state and as many bytes as fmi3SerializedFMUStateSize tells");
  }
  memcpy(bytes, state, ((const fmu_saved *)state)->size);
  return fmi3OK;
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[], size_t size, fmi3FMUState *state)
{
  fmu *const f = (fmu *)instance;
  fmu_saved *saved = state ? (fmu_saved *)*state : NULL;
  fmu_answer answer;
  if (!state) {
    return refused(f, "a place for the state is missing");
  }
  answer = f ? fmu_keep_bytes(f, &saved, bytes, size) : FMU_ERROR;
  if (answer == FMU_OK) {
    *state = saved;
  }
  return f ? told(f, answer) : fmi3Error;
}

/* ---- derivatives */

/* Vectors of references to references of numbers; 0 after a refusal. */
static int spread(fmu *f, unsigned *number, size_t n_value, const fmi3ValueReference reference[], size_t n)
{
  size_t at = 0;
  for (size_t k = 0; k < n; k++) {
    int count;
    if (!fmu_named(f, &count, reference[k], FMU_VECTORS)) {
      return 0;
    }
    for (int i = 0; i < count; i++, at++) {
      if (at < n_value) {
        number[at] = reference[k] + (unsigned)i;
      }
    }
  }
  if (at != n_value) {
    fmu_refuse(f, FMU_ERROR, "these variables are %u numbers, not %u", (unsigned)at, (unsigned)n_value);
  }
  return at == n_value;
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference unknown[], size_t n_unknown,
                                        const fmi3ValueReference known[], size_t n_known, const fmi3Float64 seed[],
                                        size_t n_seed, fmi3Float64 change[], size_t n_change)
{
  fmu *const f = (fmu *)instance;
  unsigned of[FMU_MAX_VALUES], by[FMU_MAX_VALUES];
  if (!f || !unknown || !known || !seed || !change || n_change > FMU_MAX_VALUES || n_seed > FMU_MAX_VALUES) {
    return refused(f, "a derivative wants lists of outputs, inputs and their changes");
  }
  if (!spread(f, of, n_change, unknown, n_unknown) || !spread(f, by, n_seed, known, n_known)) {
    return told(f, FMU_ERROR);
  }
  return told(f, fmu_slope(f, change, of, (int)n_change, by, seed, (int)n_seed));
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance instance, const fmi3ValueReference unknown[], size_t n_unknown,
                                    const fmi3ValueReference known[], size_t n_known, const fmi3Float64 seed[],
                                    size_t n_seed, fmi3Float64 change[], size_t n_change)
{
  fmu *const f = (fmu *)instance;
  unsigned of[FMU_MAX_VALUES], by[FMU_MAX_VALUES];
  if (!f || !unknown || !known || !seed || !change || n_change > FMU_MAX_VALUES || n_seed > FMU_MAX_VALUES) {
    return refused(f, "an adjoint derivative wants lists of outputs, their changes and inputs");
  }
  if (!spread(f, of, n_seed, unknown, n_unknown) || !spread(f, by, n_change, known, n_known)) {
    return told(f, FMU_ERROR);
  }
  return told(f, fmu_adjoint(f, change, of, seed, (int)n_seed, by, (int)n_change));
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance instance, const fmi3ValueReference reference[], size_t n,
                                    const fmi3Int32 order[], fmi3Float64 value[], size_t n_value)
{
  fmu *const f = (fmu *)instance;
  unsigned of[FMU_MAX_VALUES];
  if (!f || !reference || !order || !value || n_value > FMU_MAX_VALUES) {
    return refused(f, "derivatives by time want lists of outputs and orders, and places");
  }
  for (size_t k = 0; k < n; k++) {
    if (order[k] != 1) {
      return refused(f, "derivatives by time are of order 1 (maxOutputDerivativeOrder)");
    }
  }
  return told(f, spread(f, of, n_value, reference, n) ? fmu_rates(f, value, of, (int)n_value) : FMU_ERROR);
}

/* ---- steps */

fmi3Status fmi3EnterStepMode(fmi3Instance instance)
{
  fmu *const f = (fmu *)instance;
  return f ? told(f, fmu_change(f, FMU_EVENT, FMU_STEPPING, "the end of event mode")) : fmi3Error;
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 from, fmi3Float64 length, fmi3Boolean no_return,
                      fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *reached)
{
  fmu *const f = (fmu *)instance;
  fmu_answer answer;
  (void)no_return;
  if (!event || !terminate || !early || !reached) {
    return refused(f, "a step wants places for what it tells");
  }
  answer = f ? fmu_step(f, from, length) : FMU_ERROR;
  *terminate = fmi3False;
  *event = answer == FMU_OK && f->events && fmu_plant_is_due(&f->plant, &f->state);
  *early = answer == FMU_OK && f->stopped;
  *reached = f ? f->now.time : from;
  return f ? told(f, answer) : fmi3Error;
}

/* ---- functions of every FMU for which there is nothing here */

/* Clocks and their intervals: names and values. */
#define NO_CLOCKS(name, first, second)                                                                        \
  fmi3Status fmi3##name(fmi3Instance instance, const fmi3ValueReference reference[], size_t n, first, second) \
  {                                                                                                           \
    (void)reference, (void)a, (void)b;                                                                        \
    return n == 0 ? fmi3OK : refused((fmu *)instance, "there are no clocks");                                 \
  }
NO_CLOCKS(GetIntervalDecimal, fmi3Float64 a[], fmi3IntervalQualifier b[])
NO_CLOCKS(SetIntervalFraction, const fmi3UInt64 a[], const fmi3UInt64 b[])
NO_CLOCKS(GetShiftFraction, fmi3UInt64 a[], fmi3UInt64 b[])
NO_CLOCKS(SetShiftFraction, const fmi3UInt64 a[], const fmi3UInt64 b[])
#undef NO_CLOCKS

#define NO_CLOCK(name, only)                                                                         \
  fmi3Status fmi3##name(fmi3Instance instance, const fmi3ValueReference reference[], size_t n, only) \
  {                                                                                                  \
    (void)reference, (void)a;                                                                        \
    return n == 0 ? fmi3OK : refused((fmu *)instance, "there are no clocks");                        \
  }
NO_CLOCK(GetClock, fmi3Clock a[])
NO_CLOCK(SetClock, const fmi3Clock a[])
NO_CLOCK(SetIntervalDecimal, const fmi3Float64 a[])
NO_CLOCK(GetShiftDecimal, fmi3Float64 a[])
NO_CLOCK(SetShiftDecimal, const fmi3Float64 a[])
#undef NO_CLOCK

fmi3Status fmi3GetIntervalFraction(fmi3Instance instance, const fmi3ValueReference reference[], size_t n,
                                   fmi3UInt64 counter[], fmi3UInt64 resolution[], fmi3IntervalQualifier qualifier[])
{
  (void)reference, (void)counter, (void)resolution, (void)qualifier;
  return n == 0 ? fmi3OK : refused((fmu *)instance, "there are no clocks");
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance instance, fmi3ValueReference reference, size_t *n)
{
  (void)reference, (void)n;
  return refused((fmu *)instance,
                 "dependencies of elements are not provided (providesPerElementDependencies is false)");
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance instance, fmi3ValueReference reference, size_t of[],
                                       fmi3ValueReference by[], size_t element[], fmi3DependencyKind kind[], size_t n)
{
  (void)reference, (void)of, (void)by, (void)element, (void)kind, (void)n;
  return refused((fmu *)instance,
                 "dependencies of elements are not provided (providesPerElementDependencies is false)");
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance)
{
  return refused((fmu *)instance, "there are no structural parameters to configure");
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance)
{
  return refused((fmu *)instance, "there are no structural parameters to configure");
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance)
{
  return refused((fmu *)instance, "there are no discrete states to look at before an event happens");
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *update, fmi3Boolean *terminate,
                                    fmi3Boolean *nominals, fmi3Boolean *values, fmi3Boolean *defined, fmi3Float64 *next)
{
  fmu *const f = (fmu *)instance;
  fmu_answer answer;
  if (!f || !update || !terminate || !nominals || !values || !defined || !next) {
    return refused(f, "an update wants places for what it tells");
  }
  answer = fmu_happen(f, next);
  *update = *terminate = *nominals = *values = fmi3False;
  *defined = answer == FMU_OK && isfinite(*next);
  return told(f, answer);
}

/* ---- functions of model exchange and scheduled execution: importers look for them in any FMU */

#define OTHER_KIND "this FMU is for co-simulation alone"

#define NO_STATES(name, type)                                      \
  fmi3Status fmi3##name(fmi3Instance instance, type x[], size_t n) \
  {                                                                \
    (void)x, (void)n;                                              \
    return refused((fmu *)instance, OTHER_KIND);                   \
  }
NO_STATES(SetContinuousStates, const fmi3Float64)
NO_STATES(GetContinuousStates, fmi3Float64)
NO_STATES(GetContinuousStateDerivatives, fmi3Float64)
NO_STATES(GetNominalsOfContinuousStates, fmi3Float64)
NO_STATES(GetEventIndicators, fmi3Float64)
#undef NO_STATES

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance)
{
  return refused((fmu *)instance, OTHER_KIND);
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean no_return, fmi3Boolean *event,
                                       fmi3Boolean *terminate)
{
  (void)no_return, (void)event, (void)terminate;
  return refused((fmu *)instance, OTHER_KIND);
}

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time)
{
  (void)time;
  return refused((fmu *)instance, OTHER_KIND);
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t *n)
{
  (void)n;
  return refused((fmu *)instance, OTHER_KIND);
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t *n)
{
  (void)n;
  return refused((fmu *)instance, OTHER_KIND);
}

fmi3Status fmi3ActivateModelPartition(fmi3Instance instance, fmi3ValueReference clock, fmi3Float64 time)
{
  (void)clock, (void)time;
  return refused((fmu *)instance, OTHER_KIND);
}
