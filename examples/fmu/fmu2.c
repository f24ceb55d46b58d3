/* fmu2.c - a flexible body or a scene as a co-simulation FMU of FMI 2.0: the interface around fmu_core.h. Written into each FMU
   beside its model (build/flexbeam fmu); compile this file alone, C99, with the math library. */
#include "fmu_config.h"
#ifndef FMU_LINKED /* with an object of the library, by make */
#define FLEXBEAM_STATIC
#endif
#define FMU_INTERFACE 2
#if FMU_OF_A_SCENE
#include "fmu_scene.h"
#else
#include "flexbeam.h"
#include "fmu_variables.h"
#include "fmu_model.h"
#include "fmu_body.h"
#endif
#include "fmi2Functions.h"

typedef struct fmu_host {
  fmi2CallbackLogger logger;
  fmi2ComponentEnvironment environment;
  char name[128];
} fmu_host;

#include "fmu_core.h"
#include "fmu_instance.h"

/* Tells why an answer is none that the importer wants. */
static fmi2Status told(fmu *f, fmu_answer answer)
{
  char text[sizeof f->text];
  if (answer != FMU_OK && f->host.logger) {
    strcpy(text, f->text);
    for (char *c = text; *c; c++) { /* it is a format, with references between # */
      *c = *c == '%' || *c == '#' ? '?' : *c;
    }
    f->host.logger(f->host.environment, f->host.name, (fmi2Status)answer, "logStatusError", text);
  }
  return (fmi2Status)answer;
}

static fmi2Status refused(fmu *f, const char *why)
{
  return f ? told(f, fmu_refuse(f, FMU_ERROR, "%s", why)) : fmi2Error;
}

const char *fmi2GetTypesPlatform(void)
{
  return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
  return fmi2Version;
}

/* Errors are told in any case; there is nothing else to tell. */
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String category[])
{
  (void)on, (void)n, (void)category;
  return c ? fmi2OK : fmi2Error;
}

/* The folder of file:///FOLDER, in which %20 is a blank; empty where it is no such text, or too long. */
static void uri_to_path(char path[FMU_PATH], const char *uri)
{
  static const char *const heads[] = {"file://localhost/", "file:///", "file:/"};
  size_t n = 0, head = 0;
  path[0] = 0;
  for (int k = 0; k < 3 && head == 0; k++) {
    head = strncmp(uri, heads[k], strlen(heads[k])) == 0 ? strlen(heads[k]) : 0;
  }
  for (const char *c = uri + head - 1; head > 0 && *c; c++) {
    const char *const digits = "0123456789abcdef0123456789ABCDEF";
    const char *const high = *c == '%' && c[1] ? strchr(digits, c[1]) : NULL;
    const char *const low = high && c[2] ? strchr(digits, c[2]) : NULL;
    if (n + 1 == FMU_PATH) {
      path[0] = 0;
      return;
    }
    path[n++] = low ? (char)(16 * ((high - digits) % 16) + (low - digits) % 16) : *c;
    path[n] = 0;
    c += low ? 2 : 0;
  }
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callback, fmi2Boolean visible, fmi2Boolean on)
{
  const fmu_memory_calls calls = {callback ? callback->allocateMemory : NULL, callback ? callback->freeMemory : NULL};
  const int able = FMU_STATIC || (calls.take && calls.give);
  fmu *const f = able ? fmu_take(&calls) : NULL;
  char folder[FMU_PATH];
  fmu_answer answer;
  (void)visible, (void)on;
  if (!f) {
    if (callback && callback->logger) {
      callback->logger(callback->componentEnvironment, name, fmi2Error, "logStatusError",
                       able ? "there is no memory for one more instance" : "an instance wants memory callbacks");
    }
    return NULL;
  }
  f->host.logger = callback ? callback->logger : NULL;
  f->host.environment = callback ? callback->componentEnvironment : NULL;
  snprintf(f->host.name, sizeof f->host.name, "%s", name ? name : "");
  uri_to_path(folder, resources ? resources : "");
  answer = type == fmi2CoSimulation ? fmu_init(f, guid, folder)
                                    : fmu_refuse(f, FMU_ERROR, "this FMU is for co-simulation, not for model exchange");
  if (told(f, answer) != fmi2OK) {
    fmu_give(f);
    return NULL;
  }
  return f;
}

void fmi2FreeInstance(fmi2Component c)
{
  if (c) {
    fmu_give((fmu *)c);
  }
}

/* ---- modes */

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stop_defined, fmi2Real stop)
{
  fmu *const f = (fmu *)c;
  (void)tolerance_defined, (void)tolerance;
  return f ? told(f, fmu_begin(f, start, stop_defined != fmi2False, stop)) : fmi2Error;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
  fmu *const f = (fmu *)c;
  return f ? told(f, fmu_enter(f)) : fmi2Error;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
  fmu *const f = (fmu *)c;
  return f ? told(f, fmu_exit(f)) : fmi2Error;
}

fmi2Status fmi2Terminate(fmi2Component c)
{
  fmu *const f = (fmu *)c;
  return f ? told(f, fmu_end(f)) : fmi2Error;
}

fmi2Status fmi2Reset(fmi2Component c)
{
  if (c) {
    fmu_reset((fmu *)c);
  }
  return c ? fmi2OK : fmi2Error;
}

/* ---- values */

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference reference[], size_t n, fmi2Real value[])
{
  fmu *const f = (fmu *)c;
  return f ? told(f, fmu_get(f, reference, n, value, n, FMU_NUMBERS)) : fmi2Error;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference reference[], size_t n, const fmi2Real value[])
{
  fmu *const f = (fmu *)c;
  return f ? told(f, fmu_set(f, reference, n, value, n, FMU_NUMBERS)) : fmi2Error;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference reference[], size_t n, fmi2Integer value[])
{
  fmu *const f = (fmu *)c;
  fmu_answer answer = f && (n == 0 || (reference && value)) ? FMU_OK : FMU_ERROR;
  for (size_t k = 0; k < n && answer == FMU_OK; k++) {
    answer = fmu_get_choice(f, reference[k], &value[k]);
    told(f, answer);
  }
  return (fmi2Status)answer;
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference reference[], size_t n, const fmi2Integer value[])
{
  fmu *const f = (fmu *)c;
  fmu_answer answer = f && (n == 0 || (reference && value)) ? FMU_OK : FMU_ERROR;
  for (size_t k = 0; k < n && answer == FMU_OK; k++) {
    answer = fmu_set_choice(f, reference[k], value[k]);
    told(f, answer);
  }
  return (fmi2Status)answer;
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference reference[], size_t n, fmi2Boolean value[])
{
  (void)reference, (void)value;
  return n == 0 ? fmi2OK : refused((fmu *)c, "there are no Boolean variables");
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference reference[], size_t n, const fmi2Boolean value[])
{
  (void)reference, (void)value;
  return n == 0 ? fmi2OK : refused((fmu *)c, "there are no Boolean variables");
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference reference[], size_t n, fmi2String value[])
{
  (void)reference, (void)value;
  return n == 0 ? fmi2OK : refused((fmu *)c, "there are no strings");
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference reference[], size_t n, const fmi2String value[])
{
  (void)reference, (void)value;
  return n == 0 ? fmi2OK : refused((fmu *)c, "there are no strings");
}

/* ---- saved states */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
  fmu *const f = (fmu *)c;
  fmu_saved *saved = state ? (fmu_saved *)*state : NULL;
  fmu_answer answer;
  if (!state) {
    return refused(f, "a place for the state is missing");
  }
  answer = f ? fmu_keep(f, &saved) : FMU_ERROR;
  if (answer == FMU_OK) {
    *state = saved;
  }
  return f ? told(f, answer) : fmi2Error;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
  fmu *const f = (fmu *)c;
  return f ? told(f, fmu_load(f, (const fmu_saved *)state)) : fmi2Error;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
  if (c && state && *state) {
    fmu_give_saved((fmu *)c, (fmu_saved *)*state);
    *state = NULL;
  }
  return c ? fmi2OK : fmi2Error;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
  if (!c || !state || !size) {
    return refused((fmu *)c, "the size of a state wants a state and a place");
  }
  *size = ((const fmu_saved *)state)->size;
  return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
  if (!c || !state || !bytes || size < ((const fmu_saved *)state)->size) {
    return refused((fmu *)c, "a serialized state wants a state and as many bytes as fmi2SerializedFMUstateSize tells");
  }
  memcpy(bytes, state, ((const fmu_saved *)state)->size);
  return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
  fmu *const f = (fmu *)c;
  fmu_saved *saved = state ? (fmu_saved *)*state : NULL;
  fmu_answer answer;
  if (!state) {
    return refused(f, "a place for the state is missing");
  }
  answer = f ? fmu_keep_bytes(f, &saved, bytes, size) : FMU_ERROR;
  if (answer == FMU_OK) {
    *state = saved;
  }
  return f ? told(f, answer) : fmi2Error;
}

/* ---- derivatives */

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n_unknown,
                                        const fmi2ValueReference known[], size_t n_known, const fmi2Real by[],
                                        fmi2Real change[])
{
  fmu *const f = (fmu *)c;
  if (!f || !unknown || !known || !by || !change || n_unknown > FMU_MAX_VALUES || n_known > FMU_MAX_VALUES) {
    return refused(f, "a derivative wants lists of outputs, inputs and their changes");
  }
  return told(f, fmu_slope(f, change, unknown, (int)n_unknown, known, by, (int)n_known));
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference reference[], size_t n,
                                       const fmi2Integer order[], const fmi2Real value[])
{
  (void)reference, (void)n, (void)order, (void)value;
  return refused((fmu *)c, "inputs are held over a communication step (canInterpolateInputs is false)");
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference reference[], size_t n,
                                        const fmi2Integer order[], fmi2Real value[])
{
  fmu *const f = (fmu *)c;
  if (!f || !reference || !order || !value || n > FMU_MAX_VALUES) {
    return refused(f, "derivatives by time want lists of outputs and orders, and places");
  }
  for (size_t k = 0; k < n; k++) {
    if (order[k] != 1) {
      return refused(f, "derivatives by time are of order 1 (maxOutputDerivativeOrder)");
    }
  }
  return told(f, fmu_rates(f, value, reference, (int)n));
}

/* ---- steps */

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real from, fmi2Real length, fmi2Boolean no_return)
{
  fmu *const f = (fmu *)c;
  fmu_answer answer = f ? fmu_step(f, from, length) : FMU_ERROR;
  (void)no_return;
  if (answer == FMU_OK && f->stopped) {
    answer = fmu_refuse(f, FMU_DISCARD, "the step ends at an event at %.12g s", f->now.time);
  }
  return f ? told(f, answer) : fmi2Error;
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
  return refused((fmu *)c, "steps are not asynchronous, there is none to cancel");
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
  (void)kind, (void)value;
  return refused((fmu *)c, "steps are not asynchronous, none is pending");
}

/* The time that has been reached, also after a step that could not be made, or ended at an event. */
fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
  const fmu *const f = (const fmu *)c;
  if (!f || kind != fmi2LastSuccessfulTime || !value) {
    return refused((fmu *)c, "the real status is fmi2LastSuccessfulTime");
  }
  *value = f->now.time;
  return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
  (void)kind, (void)value;
  return refused((fmu *)c, "there is no integer status");
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
  if (!c || kind != fmi2Terminated || !value) {
    return refused((fmu *)c, "the Boolean status is fmi2Terminated");
  }
  *value = fmi2False;
  return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
  (void)kind, (void)value;
  return refused((fmu *)c, "steps are not asynchronous, none is pending");
}
