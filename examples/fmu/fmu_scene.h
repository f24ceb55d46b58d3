/* fmu_scene.h - a scene behind an FMU: what fmu_core.h asks of a plant. The folder of resources holds the text of the
   scene and the files that it names, as they are; flexbeam.txt there lists them. Everything is read and run by the
   headers of scenes, which are static: one instance in a process.

   Inputs: what adds to the scene's own functions of time, one for each load, motor, actuator and rotor that no
   controller commands, and to the references of controllers. All begin at zero: left alone, the FMU moves as the scene.
   Parameters: those of the scene, before the end of initialization, as --set has them, and the longest step. */
#ifndef FMU_SCENE_H
#define FMU_SCENE_H
#include "../scene/scene_run.h"
#include <stddef.h>
#include "fmu_variables.h"

#define FMU_SCENE_INPUTS (SCENE_LOADS + SCENE_DRIVES + FB_MAX_SPRINGS + SCENE_ROTORS + SCENE_CONTROLS)
#define FMU_SCENE_VARIABLES (FMU_SCENE_INPUTS + SCENE_OUTPUTS + SCENE_PARAMETERS + 2)
typedef char
    fmu_scenes_have_room[FMU_SCENE_VARIABLES <= FMU_MAX_VARIABLES && FMU_SCENE_VARIABLES <= FMU_MAX_VALUES ? 1 : -1];

typedef struct fmu_plant {
  int opened;
} fmu_plant;

typedef struct fmu_plant_state { /* all that changes in a scene that runs */
  double time, interval, unit;   /* [s] of the scene; of timing; the last communication step that is no row of it */
  double longest, part;          /* of timing */
  fb_integrator integrator;
  int event, halved; /* of the run */
  double origin[SCENE_JOINTS][3];
  struct scene_controlling controlling[SCENE_CONTROLS]; /* the first n_control, and.. */
  union {
    fb_state body;
    fb_system_state system;
    fb_exact_state exact;
  } of; /* ..of this what the scene is */
} fmu_plant_state;

typedef struct fmu_scene_input {
  function *f;
  double size; /* of the load that it is a part of */
} fmu_scene_input;

static struct fmu_staged { /* one scene in a process */
  int taken, made;
  char token[48], path[FMU_PATH + 200];
  double step; /* the start value of settings.step */
  scene s;
  scene_run_state run;
  fmu_scene_input input[FMU_SCENE_INPUTS];
  int n_input, n_variable;
  fmu_variable variable[FMU_SCENE_VARIABLES];
  char name[FMU_SCENE_VARIABLES][FMU_NAME], unit[FMU_SCENE_VARIABLES][40];
  int n_exported, n_parameter; /* variables of the FMU and parameters of the scene as it was exported */
  char exported[FMU_SCENE_VARIABLES][FMU_NAME], parameter[SCENE_PARAMETERS][TEXT_NAME];
  double built[SCENE_PARAMETERS]; /* parameters, and.. */
  double built_step;              /* ..the step that the scene was built with */
} staged;

static const scene_options fmu_scene_quiet; /* no files, no talk */

static fmu_answer fmu_scene_said(fmu_text text, fmu_answer answer, const char *what)
{
  snprintf(text, sizeof(fmu_text), "%.700s", what);
  return answer;
}

/* ---- variables */

/* A unit as FMI has it: N.m, m/s2; NULL: none. */
static const char *fmu_scene_unit(char to[40], const char *unit)
{
  size_t n = 0;
  for (const char *c = unit; *c && n < 39; c++) {
    if (*c != '^') {
      to[n++] = *c;
      to[n - 1] = *c == ' ' ? '.' : *c;
    }
  }
  to[n] = 0;
  return strcmp(to, "-") == 0 || n == 0 ? NULL : to;
}

/* One more variable; the name is a format with one text in it. */
static fmu_variable *fmu_scene_add(fmu_kind kind, const char *head, const char *name, const char *unit)
{
  const int k = staged.n_variable++;
  fmu_variable *const v = &staged.variable[k];
  memset(v, 0, sizeof *v);
  v->kind = kind;
  v->node = v->first = k;
  v->count = 1;
  snprintf(staged.name[k], sizeof staged.name[k], "%.40s%.40s", head, name);
  v->name = staged.name[k];
  v->unit = fmu_scene_unit(staged.unit[k], unit);
  return v;
}

/* motor.axle.1 becomes motor.axle[1], torque.hub.0 torque.hub; the second one of a name force_2.boom.tip. */
static void fmu_scene_name(char name[FMU_NAME], const char *plain)
{
  const char *const dot = strrchr(plain, '.'), *const first = strchr(plain, '.');
  const int number = dot && dot[1] >= '0' && dot[1] <= '9';
  const int whole = number ? (int)(dot - plain) : (int)strlen(plain);
  for (int same = 1, taken = 1; taken; same++) {
    char count[16] = "";
    if (same > 1) {
      snprintf(count, sizeof count, "_%d", same);
    }
    snprintf(name, FMU_NAME, "%.*s%s%.*s", (int)(first - plain), plain, count, whole - (int)(first - plain), first);
    if (number && strcmp(dot, ".0") != 0) {
      snprintf(name + strlen(name), FMU_NAME - strlen(name), "[%.8s]", dot + 1);
    }
    taken = 0;
    for (int k = 0; k < staged.n_variable; k++) {
      taken |= strcmp(staged.name[k], name) == 0;
    }
  }
}

/* What adds to a function of the scene; size: of what it drives, 1 for its unit. */
static void fmu_scene_add_input(function *f, double size, const char *plain, const char *unit)
{
  char name[FMU_NAME];
  scene_output as = {0};
  scene_unit(&staged.s, &as, unit);
  fmu_scene_name(name, plain);
  fmu_scene_add(FMU_SCENE_INPUT, "", name, as.unit)->what = "added to what the scene says";
  strcpy(staged.name[staged.n_variable - 1], name);
  staged.input[staged.n_input].f = f;
  staged.input[staged.n_input++].size = size;
}

/* Has what drives the scene a function that no controller replaces? size: as above. */
static function *fmu_scene_function(scene *s, scene_actor actor, int at, double *size)
{
  *size = 1;
  if (actor == SCENE_BY_MOTOR) {
    return s->drive[at].kind == SCENE_MOTOR && s->drive[at].control < 0 ? &s->drive[at].f : NULL;
  }
  if (actor == SCENE_BY_PULL) {
    return s->spring[at].pulls ? &s->spring[at].pull : NULL;
  }
  if (actor == SCENE_BY_ROTOR) {
    return s->body[s->rotor[at].body].level.rotor[s->rotor[at].at].given ? NULL : &s->rotor[at].f;
  }
  *size = hypot(hypot(s->load[at].vector[0], s->load[at].vector[1]), s->load[at].vector[2]);
  return s->load[at].nudge || s->load[at].control >= 0 || !(*size > 0) ? NULL : &s->load[at].f;
}

static void fmu_scene_add_inputs(scene *s)
{
  staged.n_input = 0;
  for (int actor = SCENE_BY_MOTOR; actor <= SCENE_BY_ROTOR; actor++) {
    const int count[] = {0, s->n_drive, s->n_spring, s->n_load, s->n_rotor};
    for (int k = 0; k < count[actor]; k++) {
      const plant_input in = {.actor = (scene_actor)actor, .at = k};
      char name[80];
      double size;
      function *const f = fmu_scene_function(s, in.actor, k, &size);
      const char *const unit = f ? plant_input_name(name, s, &in) : "";
      if (f) {
        fmu_scene_add_input(f, size, name, unit);
      }
    }
  }
  for (int k = 0; k < s->n_control; k++) {
    char name[80];
    snprintf(name, sizeof name, "reference.%s", s->control[k].name);
    fmu_scene_add_input(&s->control[k].reference, 1, name, "-");
  }
}

/* Does it follow loads and motors at once? */
static int fmu_scene_is_direct(const scene *s, const scene_output *o)
{
  switch (o->quantity) {
  case SCENE_ACCELERATION:
  case SCENE_RATE_DOT:
  case SCENE_SPECIFIC_FORCE:
  case SCENE_INTERNAL_FORCE:
  case SCENE_INTERNAL_MOMENT:
  case SCENE_REACTION_FORCE:
  case SCENE_REACTION_TORQUE:
  case SCENE_JOINT_FORCE:
  case SCENE_JOINT_TORQUE:
  case SCENE_COORDINATE_ACCELERATION:
  case SCENE_DRIVE:
  case SCENE_TENSION:
  case SCENE_POWER:
    return !s->is_exact;
  default:
    return 0;
  }
}

/* The variables of the scene that was read. */
static void fmu_scene_list(scene *s)
{
  staged.n_variable = 0;
  fmu_scene_add(FMU_TIME, "time", "", "s");
  fmu_scene_add_inputs(s);
  for (int k = 0; k < s->n_output; k++) {
    fmu_variable *const v = fmu_scene_add(FMU_SCENE_OUTPUT, "output.", s->output[k].label, s->output[k].unit);
    v->node = k;
    v->what = scene_quantities[s->output[k].quantity].name;
    v->direct = fmu_scene_is_direct(s, &s->output[k]);
  }
  fmu_scene_add(FMU_SCENE_STEP, "settings.step", "", "s")->start = staged.step;
  for (int k = 0; k < s->n_parameter; k++) {
    fmu_variable *const v = fmu_scene_add(FMU_SCENE_PARAMETER, "parameter.", s->parameter[k].name, "-");
    v->node = k;
    v->start = s->parameter[k].value;
  }
}

/* ---- the folder */

/* Goes on with a check word over the bytes of a file. 0: it cannot be read. */
static int fmu_scene_word(unsigned *word, const char *path)
{
  FILE *const file = fopen(path, "rb");
  unsigned part = 0;
  if (!file) {
    return 0;
  }
  while (fread(&part, 1, sizeof part, file) > 0) {
    *word = fbi_crc_word(*word, part);
    part = 0;
  }
  fclose(file);
  return 1;
}

static void fmu_scene_token(unsigned list, unsigned files)
{
  unsigned version = fbi_crc_word(~0u, FMU_INTERFACE);
  for (const char *c = FB_VERSION; *c; c++) {
    version = fbi_crc_word(version, (unsigned char)*c);
  }
  snprintf(staged.token, sizeof staged.token, "{%08x-%04x-%04x-%04x-%04x%08x}", list, files >> 16, files & 0xFFFFu,
           version >> 16, version & 0xFFFFu, files ^ version);
}

/* flexbeam.txt: `scene FILE`, `step SECONDS`, `file FILE` for each other one. Their check words are the token. */
static fmu_answer fmu_scene_open(const char *resources, fmu_text text)
{
  const size_t n = strlen(resources);
  const char *const slash = n > 0 && resources[n - 1] == '/' ? "" : "/";
  char at[FMU_PATH + 200], path[FMU_PATH + 200], message[TEXT_MESSAGE] = "";
  unsigned list = ~0u, files = ~0u;
  const char *word;
  text_file t;
  snprintf(at, sizeof at, "%s%sflexbeam.txt", resources, slash);
  if (!fmu_scene_word(&list, at) || !text_try(&t, "fmu", at)) {
    snprintf(text, sizeof(fmu_text), "no scene: %.500s: %s", n > 0 ? at : "no folder of resources is given",
             n > 0 ? strerror(errno) : "the scene is there");
    return FMU_ERROR;
  }
  t.message = message;
  staged.path[0] = 0;
  while (text_line(&t) && (word = text_word(&t)) != NULL) {
    const int is_scene = strcmp(word, "scene") == 0;
    if (strcmp(word, "step") == 0) {
      staged.step = text_number(&t, "step");
    } else if ((word = text_word(&t)) == NULL) {
      text_fail(&t, "the name of a file is missing");
    } else {
      snprintf(path, sizeof path, "%s%s%s", resources, slash, word);
      if (!fmu_scene_word(&files, path)) {
        text_fail(&t, "%s: %s", path, strerror(errno));
      }
      if (is_scene) {
        memcpy(staged.path, path, sizeof path);
      }
    }
  }
  text_close(&t);
  if (t.failed || !staged.path[0]) {
    return fmu_scene_said(text, FMU_ERROR, t.failed ? message : "flexbeam.txt among the resources names no scene");
  }
  fmu_scene_token(list, files);
  return FMU_OK;
}

/* ---- the scene */

/* Reads it, with these parameters; NULL: its own. */
static fmu_answer fmu_scene_read(const char *path, const double *parameter, double step, fmu_text text)
{
  scene *const s = &staged.s;
  scene_setting set[SCENE_PARAMETERS];
  const int n = parameter ? staged.n_parameter : 0;
  const char *const slash = strrchr(path, '/');
  for (int k = 0; k < n; k++) {
    set[k].name = staged.parameter[k];
    set[k].value = parameter[k];
  }
  staged.made = 0;
  if (scene_read(s, path, set, n)) {
    return fmu_scene_said(text, FMU_ERROR, s->message);
  }
  s->step = step > 0 ? step : s->step;
  memmove(s->path, slash ? slash + 1 : s->path, slash ? strlen(slash) : strlen(s->path) + 1); /* messages */
  if (!(s->duration > 0)) {
    scene_fail(s, "a scene without duration computes its start alone: no motion that an FMU could step");
    return fmu_scene_said(text, FMU_ERROR, s->message);
  }
  return FMU_OK;
}

/* The variables again: a load that a parameter makes zero has no input. */
static fmu_answer fmu_scene_relist(fmu_text text)
{
  const int n = staged.n_exported;
  fmu_scene_list(&staged.s);
  for (int k = 0; k < n || k < staged.n_variable; k++) {
    if (k >= n || k >= staged.n_variable || strcmp(staged.exported[k], staged.name[k]) != 0) {
      snprintf(text, sizeof(fmu_text),
               "with these parameters the scene has other variables than the FMU (%s): export it with them",
               k < n ? staged.exported[k] : staged.name[k]);
      return FMU_ERROR;
    }
  }
  return FMU_OK;
}

/* Bodies of these parameters. Nothing of the inputs is in what is built. */
static fmu_answer fmu_scene_make(const double *parameter, double step, fmu_text text)
{
  fmu_answer answer = fmu_scene_read(staged.path, parameter, step, text);
  answer = answer ? answer : fmu_scene_relist(text);
  if (answer != FMU_OK) {
    return answer;
  }
  memset(&engine, 0, sizeof engine);
  if (scene_build(&staged.s, &fmu_scene_quiet)) {
    return fmu_scene_said(text, FMU_ERROR, staged.s.message);
  }
  for (int k = 0; k < staged.s.n_parameter; k++) {
    staged.built[k] = parameter[k];
  }
  staged.built_step = step;
  staged.made = 1;
  return FMU_OK;
}

/* The scene as the values have it. */
static fmu_answer fmu_scene_set(const fmu_values *v, fmu_text text)
{
  double parameter[SCENE_PARAMETERS] = {0}, step = 0;
  int same = staged.made, n = 0;
  for (int k = 0; k < v->n; k++) {
    const fmu_variable *const one = &v->variable[k];
    if (one->kind == FMU_SCENE_PARAMETER) {
      parameter[n++] = v->value[k];
    }
    step = one->kind == FMU_SCENE_STEP ? v->value[k] : step;
  }
  for (int k = 0; k < n; k++) {
    same = same && !(parameter[k] < staged.built[k] || parameter[k] > staged.built[k]);
  }
  if (!same || step < staged.built_step || step > staged.built_step) {
    const fmu_answer answer = fmu_scene_make(parameter, step, text);
    if (answer != FMU_OK) {
      return answer;
    }
  }
  for (int k = 0; k < staged.n_input; k++) { /* behind time */
    staged.input[k].f->added = v->value[1 + k] / staged.input[k].size;
  }
  return FMU_OK;
}

/* The part of a state that this scene has. */
static inline void fmu_plant_copy(fmu_plant_state *to, const fmu_plant_state *from)
{
  const size_t head =
      offsetof(fmu_plant_state, controlling) + (size_t)staged.s.n_control * sizeof(struct scene_controlling);
  memcpy(to, from, head);
  if (staged.s.is_exact) {
    to->of.exact = from->of.exact;
  } else if (scene_is_system(&staged.s)) {
    to->of.system = from->of.system;
  } else {
    to->of.body = from->of.body;
  }
}

/* A state into what runs, and back. */
static void fmu_scene_load(const fmu_plant_state *state)
{
  const size_t known = (size_t)staged.s.n_control * sizeof(struct scene_controlling);
  if (engine.integrator != state->integrator) {
    engine.by_step = 0;
  }
  engine.integrator = state->integrator;
  timing.interval = state->interval;
  timing.slack = 1e-9 * timing.interval;
  timing.longest = state->longest;
  timing.part = state->part;
  staged.run.event = state->event;
  staged.run.halved = state->halved;
  memcpy(engine.origin, state->origin, sizeof engine.origin);
  memcpy(controlling, state->controlling, known);
  if (staged.s.is_exact) {
    exact.state = state->of.exact;
  } else if (scene_is_system(&staged.s)) {
    engine.system_state = state->of.system;
  } else {
    engine.state = state->of.body;
  }
}

static void fmu_scene_store(fmu_plant_state *state)
{
  const size_t known = (size_t)staged.s.n_control * sizeof(struct scene_controlling);
  state->integrator = engine.integrator;
  state->interval = timing.interval;
  state->longest = timing.longest;
  state->part = timing.part;
  state->event = staged.run.event;
  state->halved = staged.run.halved;
  memcpy(state->origin, engine.origin, sizeof engine.origin);
  memcpy(state->controlling, controlling, known);
  if (staged.s.is_exact) {
    state->of.exact = exact.state;
  } else if (scene_is_system(&staged.s)) {
    state->of.system = engine.system_state;
  } else {
    state->of.body = engine.state;
  }
}

/* ---- what the core asks for */

static inline void fmu_plant_close(fmu_plant *p)
{
  staged.taken = staged.taken && !p->opened;
  p->opened = 0;
}

static fmu_answer fmu_plant_open(fmu_plant *p, const char *resources, fmu_text text)
{
  fmu_answer answer;
  if (staged.taken) {
    return fmu_scene_said(text, FMU_ERROR, "there is an instance in this process already, and a scene takes one");
  }
  memset(&staged, 0, sizeof staged);
  answer = fmu_scene_open(resources, text);
  answer = answer ? answer : fmu_scene_read(staged.path, NULL, 0, text);
  if (answer == FMU_OK) {
    fmu_scene_list(&staged.s);
    memcpy(staged.exported, staged.name, sizeof staged.exported);
    staged.n_exported = staged.n_variable;
    staged.n_parameter = staged.s.n_parameter;
    for (int k = 0; k < staged.n_parameter; k++) {
      strcpy(staged.parameter[k], staged.s.parameter[k].name);
    }
    staged.taken = p->opened = 1;
  }
  (void)scene_run; /* it runs a scene from end to end; here somebody else has the clock */
  return answer;
}

static const char *fmu_plant_token(const fmu_plant *p)
{
  (void)p;
  return staged.token;
}

static int fmu_plant_variables(const fmu_plant *p, fmu_variable *list)
{
  (void)p;
  memcpy(list, staged.variable, (size_t)staged.n_variable * sizeof *list);
  return staged.n_variable;
}

static inline double fmu_plant_default(const fmu_variable *v, int element)
{
  (void)element;
  return v->start;
}

static inline const char *fmu_plant_node(const fmu_variable *v)
{
  (void)v;
  return "";
}

static fmu_answer fmu_plant_start(fmu_plant *p, fmu_plant_state *state, const fmu_values *v, fmu_text text)
{
  scene *const s = &staged.s;
  fmu_answer answer = fmu_scene_set(v, text);
  fb_status status = FB_OK;
  (void)p;
  if (answer != FMU_OK) {
    return answer;
  }
  status = scene_start(s);
  if (status != FB_OK) {
    scene_no_start(s, status);
    return fmu_scene_said(text, FMU_ERROR, s->message);
  }
  scene_clock_init(s, scene_rows(s));
  scene_choose(s);
  if (scene_check_steps(s, &fmu_scene_quiet)) {
    return fmu_scene_said(text, FMU_ERROR, s->message);
  }
  engine.by_step = 0;
  staged.run.event = staged.run.halved = 0;
  memset(state, 0, sizeof *state);
  fmu_scene_store(state);
  return FMU_OK;
}

/* From start to last, which is `interval` away. */
static fb_status fmu_scene_interval(fmu_plant_state *state, double start, double last, double interval, char when[96])
{
  timing.interval = interval;
  timing.slack = 1e-9 * interval;
  state->time = last;
  return scene_interval(&staged.s, &staged.run, start, last, when);
}

static int fmu_scene_same(double a, double b, double scale)
{
  return fabs(a - b) <= FMU_SAME * scale;
}

/* A communication step. Where it is a number of rows of the scene, those, to the last bit. Else one interval of its
   own, from a multiple of it to the next where the time is one: the same steps in each. */
static fb_status fmu_scene_advance(fmu_plant_state *state, double length, char when[96])
{
  const double row = staged.s.duration / (double)timing.rows, many = floor(length / row + 0.5);
  const double at = floor(state->time / row + 0.5);
  double unit, start, last;
  fb_status status = FB_OK;
  if (many >= 1 && fmu_scene_same(length, many * row, length) && fmu_scene_same(state->time, at * row, row)) {
    for (double k = 0; k < many && status == FB_OK; k++) {
      status = fmu_scene_interval(state, (at + k) * row, (at + k + 1) * row, row, when);
    }
    return status;
  }
  unit = fmu_scene_same(length, state->unit, length) ? state->unit : length;
  state->unit = unit;
  start = floor(state->time / unit + 0.5);
  if (fmu_scene_same(state->time, start * unit, unit)) {
    return fmu_scene_interval(state, start * unit, (start + 1) * unit, unit, when);
  }
  last = floor((state->time + length) / row + 0.5) * row; /* a row, where it is one */
  last = fmu_scene_same(last, state->time + length, row) ? last : state->time + length;
  return fmu_scene_interval(state, state->time, last, last - state->time, when);
}

static fmu_answer fmu_plant_step(fmu_plant *p, fmu_plant_state *state, const fmu_values *v, double from, double length,
                                 fmu_text text)
{
  const fmu_answer answer = fmu_scene_set(v, text);
  char when[96] = "at the start";
  fb_status status;
  (void)p, (void)from;
  if (answer != FMU_OK) {
    return answer;
  }
  fmu_scene_load(state);
  status = fmu_scene_advance(state, length, when);
  fmu_scene_store(state);
  if (status != FB_OK) {
    scene_failed(&staged.s, when, status);
    return fmu_scene_said(text, FMU_DISCARD, staged.s.message);
  }
  return FMU_OK;
}

static fmu_answer fmu_plant_outputs(fmu_plant *p, const fmu_plant_state *state, const fmu_values *v, fmu_text text)
{
  scene *const s = &staged.s;
  const fmu_answer answer = fmu_scene_set(v, text);
  fb_status status;
  (void)p;
  if (answer != FMU_OK) {
    return answer;
  }
  fmu_scene_load(state);
  status = scene_look(s, state->time);
  for (int k = 0; k < s->n_output && status == FB_OK; k++) { /* behind time and inputs */
    v->value[1 + staged.n_input + k] = scene_value(s, &s->output[k]);
  }
  if (status != FB_OK) {
    scene_failed(s, "outputs", status);
    return fmu_scene_said(text, FMU_ERROR, s->message);
  }
  return FMU_OK;
}
#endif
