/* fmu_scene.h - a scene behind an FMU: what fmu_core.h asks of a plant. The folder of resources holds the text of the
   scene and the files that it names, as they are; flexbeam.txt there lists them. Everything is read and run by the
   headers of scenes. What runs is the instance's own; reading and building take turns among the threads.

   Inputs: what adds to the scene's own functions of time, one for each load, motor, actuator and rotor that no
   controller commands, to the references of controllers, and to the motion of a base, two each: a velocity, and its rate,
   by which it goes on. All begin at zero: left alone, the FMU moves as the scene.
   Parameters: those of the scene, before the end of initialization, as --set has them, and the longest step. */
#ifndef FMU_SCENE_H
#define FMU_SCENE_H
#define SCENE_SEVERAL
#include "../scene/scene_run.h"
#include <stddef.h>
#ifdef __unix__
#include <sched.h>
#endif
#include "fmu_variables.h"

#define FMU_SCENE_REFERENCES (SCENE_CONTROLS * CONTROL_SIGNALS)
#define FMU_SCENE_INPUTS \
  (SCENE_LOADS + SCENE_DRIVES + FB_MAX_SPRINGS + SCENE_ROTORS + FMU_SCENE_REFERENCES + 2 * SCENE_MOTIONS)
#define FMU_SCENE_VARIABLES (FMU_SCENE_INPUTS + SCENE_OUTPUTS + SCENE_PARAMETERS + 3)
typedef char
    fmu_scenes_have_room[FMU_SCENE_VARIABLES <= FMU_MAX_VARIABLES && FMU_SCENE_VARIABLES <= FMU_MAX_VALUES ? 1 : -1];

typedef struct fmu_plant_state { /* all that changes in a scene that runs */
  double time, interval, unit;   /* [s] of the scene; of timing; the last communication step that is no row of it */
  double longest, part;          /* of timing */
  fb_integrator integrator;
  int event, halved; /* of the run */
  struct scene_controlling controlling[SCENE_CONTROLS];
  double remembered[SCENE_REMEMBERED]; /* the first n_remembered */
  double origin[SCENE_JOINTS][3];      /* of the joints that there are, and.. */
  union {
    fb_state body;
    fb_system_state system;
    fb_exact_state exact;
  } of; /* ..of this what the scene is */
} fmu_plant_state;

typedef struct fmu_scene_input {
  function *f;
  double size; /* of the load that it is a part of */
  int is_rate; /* it is the rate of the input before it */
} fmu_scene_input;

typedef struct fmu_plant { /* large, but for what the scene has not: that stays as it was taken, zeros */
  int made, begun;         /* is it built for the parameters below, and started since? */
  int used;                /* was anything built before? */
  int is_alone;     /* no FMU, but examples/bindings: may be a scene without duration; paths, units as in files */
  const char *text; /* of the scene; NULL: that of the file at.. */
  char token[48], path[FMU_PATH + 200];
  double step;           /* the start value of settings.step */
  scene_options options; /* no files, no talk, where nobody asks */
  scene_run_state run;
  double spin, acceleration;       /* of `automatic`, and.. */
  fb_advice advice[FB_MAX_BODIES]; /* ..that of its bodies, as they were built */
  fmu_scene_input input[FMU_SCENE_INPUTS];
  int n_input, n_variable;
  fmu_variable variable[FMU_SCENE_VARIABLES];
  char name[FMU_SCENE_VARIABLES][FMU_NAME], unit[FMU_SCENE_VARIABLES][40];
  int n_exported, n_parameter; /* variables of the FMU and parameters of the scene as it was exported */
  char exported[FMU_SCENE_VARIABLES][FMU_NAME], parameter[SCENE_PARAMETERS][TEXT_NAME];
  double built[SCENE_PARAMETERS]; /* parameters, and.. */
  double built_step;              /* ..the step that the scene was built with */
  scene s;
  struct scene_clock clock;
  struct scene_controlling controller[SCENE_CONTROLS];
  double remembered[SCENE_REMEMBERED];
  struct scene_engine moving;
  struct scene_exact bending;
} fmu_plant;

/* This thread runs p from here on. */
static void fmu_scene_here(fmu_plant *p)
{
  engine_now = &p->moving;
  exact_run_now = &p->bending;
  timing_now = &p->clock;
  controlling_now = p->controller;
  remembered_now = p->remembered;
}

/* Reading and building have static memory of their own: one thread at a time; those that wait leave their core to it. */
static int fmu_scene_builds;

static void fmu_scene_wait(void)
{
#ifdef __GNUC__
  while (__sync_lock_test_and_set(&fmu_scene_builds, 1)) {
#ifdef __unix__
    sched_yield();
#endif
  }
#endif
}

static void fmu_scene_done(void)
{
#ifdef __GNUC__
  __sync_lock_release(&fmu_scene_builds);
#endif
}

static fmu_answer fmu_scene_said(fmu_text text, fmu_answer answer, const char *what)
{
  snprintf(text, sizeof(fmu_text), "%.700s", what);
  return answer;
}

/* ---- variables */

/* A unit as FMI has it: N.m, m/s2; NULL: none. */
static const char *fmu_scene_unit(const fmu_plant *p, char to[40], const char *unit)
{
  size_t n = 0;
  if (p->is_alone) {
    snprintf(to, 40, "%s", unit);
    return to;
  }
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
static fmu_variable *fmu_scene_add(fmu_plant *p, fmu_kind kind, const char *head, const char *name, const char *unit)
{
  const int k = p->n_variable++;
  fmu_variable *const v = &p->variable[k];
  memset(v, 0, sizeof *v);
  v->kind = kind;
  v->node = v->first = k;
  v->count = 1;
  snprintf(p->name[k], sizeof p->name[k], "%.40s%.40s", head, name);
  v->name = p->name[k];
  v->unit = fmu_scene_unit(p, p->unit[k], unit);
  return v;
}

/* motor.axle.1 becomes motor.axle[1], torque.hub.0 torque.hub; the second one of a name force_2.boom.tip. */
static void fmu_scene_name(fmu_plant *p, char name[FMU_NAME], const char *plain)
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
    for (int k = 0; k < p->n_variable; k++) {
      taken |= strcmp(p->name[k], name) == 0;
    }
  }
}

/* What adds to a function of the scene; size: of what it drives, 1 for its unit. */
static void fmu_scene_add_input(fmu_plant *p, function *f, double size, const char *plain, const char *unit)
{
  char name[FMU_NAME];
  scene_output as = {0};
  scene_unit(&p->s, &as, unit);
  fmu_scene_name(p, name, plain);
  fmu_scene_add(p, FMU_SCENE_INPUT, "", name, as.unit)->what = "added to what the scene says";
  strcpy(p->name[p->n_variable - 1], name);
  p->input[p->n_input].f = f;
  p->input[p->n_input].is_rate = 0;
  p->input[p->n_input++].size = size;
}

/* The motion of the base, and its rate. */
static void fmu_scene_add_motion(fmu_plant *p, scene_motion *motion)
{
  static const char *const name[2][2] = {{"velocity.base", "acceleration.base"},
                                         {"rate.base", "angular_acceleration.base"}};
  static const char *const unit[2][2] = {{"m/s", "m/s^2"}, {"rad/s", "rad/s^2"}};
  const double *const x = motion->vector, size = hypot(hypot(x[0], x[1]), x[2]);
  for (int rate = 0; rate < 2 && size > 0 && !motion->support; rate++) { /* a place would jump with each call */
    fmu_scene_add_input(p, &motion->f, size, name[motion->rate][rate], unit[motion->rate][rate]);
    p->input[p->n_input - 1].is_rate = rate;
  }
}

/* Has what drives the scene a function that no controller replaces? size: as above. */
static function *fmu_scene_function(scene *s, scene_actor actor, int at, double *size)
{
  *size = 1;
  if (actor == SCENE_BY_MOTOR) {
    return s->drive[at].kind == SCENE_MOTOR && s->drive[at].act < 0 ? &s->drive[at].f : NULL;
  }
  if (actor == SCENE_BY_PULL) {
    return s->spring[at].pulls ? &s->spring[at].pull : NULL;
  }
  if (actor == SCENE_BY_ROTOR) {
    return s->body[s->rotor[at].body].level.rotor[s->rotor[at].at].given ? NULL : &s->rotor[at].f;
  }
  *size = hypot(hypot(s->load[at].vector[0], s->load[at].vector[1]), s->load[at].vector[2]);
  return s->load[at].nudge || s->load[at].act >= 0 || !(*size > 0) ? NULL : &s->load[at].f;
}

/* References of a controller, or the turns of its attitude; with a number where there are several. */
static void fmu_scene_add_references(fmu_plant *p, scene_control *c)
{
  const int turns = c->attitude.is, n = turns ? c->attitude.n_turn : c->n_signal;
  for (int i = 0; i < n; i++) {
    char name[80];
    snprintf(name, sizeof name, n > 1 ? "reference.%s.%d" : "reference.%s", c->name, i + 1);
    fmu_scene_add_input(p, turns ? &c->attitude.turn[i].f : &c->reference[i], 1, name, turns ? "rad" : "-");
  }
}

static void fmu_scene_add_inputs(fmu_plant *p, scene *s)
{
  p->n_input = 0;
  for (int actor = SCENE_BY_MOTOR; actor <= SCENE_BY_ROTOR; actor++) {
    const int count[] = {0, s->n_drive, s->n_spring, s->n_load, s->n_rotor};
    for (int k = 0; k < count[actor]; k++) {
      const plant_input in = {.actor = (scene_actor)actor, .at = k};
      char name[80];
      double size;
      function *const f = fmu_scene_function(s, in.actor, k, &size);
      const char *const unit = f ? plant_input_name(name, s, &in) : "";
      if (f) {
        fmu_scene_add_input(p, f, size, name, unit);
      }
    }
  }
  for (int k = 0; k < s->n_control; k++) {
    fmu_scene_add_references(p, &s->control[k]);
  }
  for (int k = 0; k < s->n_motion; k++) {
    fmu_scene_add_motion(p, &s->motion[k]);
  }
}

/* Does it follow loads and motors at once, or the motion of a base? */
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
  case SCENE_VELOCITY:
  case SCENE_RATE:
  case SCENE_GYRO:
  case SCENE_SPIN:
  case SCENE_MODE_RATE:
  case SCENE_ROTOR_SPEED:
  case SCENE_ENERGY:
  case SCENE_MOMENTUM:
  case SCENE_ANGULAR_MOMENTUM:
    return s->n_motion > 0 && !s->is_exact;
  default:
    return 0;
  }
}

/* The variables of the scene that was read. */
static void fmu_scene_list(fmu_plant *p, scene *s)
{
  p->n_variable = 0;
  fmu_scene_add(p, FMU_TIME, "time", "", "s");
  fmu_scene_add_inputs(p, s);
  for (int k = 0; k < s->n_output; k++) {
    fmu_variable *const v = fmu_scene_add(p, FMU_SCENE_OUTPUT, "output.", s->output[k].label, s->output[k].unit);
    v->node = k;
    v->what = scene_quantities[s->output[k].quantity].name;
    v->direct = fmu_scene_is_direct(s, &s->output[k]);
  }
  fmu_scene_add(p, FMU_SCENE_STEP, "settings.step", "", "s")->start = p->step;
  if (FMU_INTERFACE == 2 && s->n_event > 0) {
    fmu_scene_add(p, FMU_SCENE_EARLY, "settings.early_return", "", "");
  }
  for (int k = 0; k < s->n_parameter; k++) {
    fmu_variable *const v = fmu_scene_add(p, FMU_SCENE_PARAMETER, "parameter.", s->parameter[k].name, "-");
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

static void fmu_scene_token(fmu_plant *p, unsigned list, unsigned files)
{
  unsigned version = fbi_crc_word(~0u, FMU_INTERFACE);
  for (const char *c = FB_VERSION; *c; c++) {
    version = fbi_crc_word(version, (unsigned char)*c);
  }
  snprintf(p->token, sizeof p->token, "{%08x-%04x-%04x-%04x-%04x%08x}", list, files >> 16, files & 0xFFFFu,
           version >> 16, version & 0xFFFFu, files ^ version);
}

/* flexbeam.txt: `scene FILE`, `step SECONDS`, `file FILE` for each other one. Their check words are the token. */
static fmu_answer fmu_scene_open(fmu_plant *p, const char *resources, fmu_text text)
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
  p->path[0] = 0;
  while (text_line(&t) && (word = text_word(&t)) != NULL) {
    const int is_scene = strcmp(word, "scene") == 0;
    if (strcmp(word, "step") == 0) {
      p->step = text_number(&t, "step");
    } else if ((word = text_word(&t)) == NULL) {
      text_fail(&t, "the name of a file is missing");
    } else {
      snprintf(path, sizeof path, "%s%s%s", resources, slash, word);
      if (!fmu_scene_word(&files, path)) {
        text_fail(&t, "%s: %s", path, strerror(errno));
      }
      if (is_scene) {
        memcpy(p->path, path, sizeof path);
      }
    }
  }
  text_close(&t);
  if (t.failed || !p->path[0]) {
    return fmu_scene_said(text, FMU_ERROR, t.failed ? message : "flexbeam.txt among the resources names no scene");
  }
  fmu_scene_token(p, list, files);
  return FMU_OK;
}

/* ---- the scene */

/* Reads it, with these parameters; NULL: its own. */
static fmu_answer fmu_scene_read(fmu_plant *p, const char *path, const double *parameter, double step, fmu_text text)
{
  scene *const s = &p->s;
  scene_setting set[SCENE_PARAMETERS];
  const int n = parameter ? p->n_parameter : 0;
  const char *const slash = strrchr(path, '/');
  for (int k = 0; k < n; k++) {
    set[k].name = p->parameter[k];
    set[k].value = parameter[k];
  }
  p->made = 0;
  fmu_scene_here(p);
  if (scene_read_of(s, path, p->text, set, n)) {
    return fmu_scene_said(text, FMU_ERROR, s->message);
  }
  s->step = step > 0 ? step : s->step;
  if (p->is_alone) {
    return FMU_OK;
  }
  memmove(s->path, slash ? slash + 1 : s->path, slash ? strlen(slash) : strlen(s->path) + 1); /* messages */
  if (!(s->duration > 0)) {
    scene_fail(s, "a scene without duration computes its start alone: no motion that an FMU could step");
    return fmu_scene_said(text, FMU_ERROR, s->message);
  }
  return FMU_OK;
}

/* The variables again: a load that a parameter makes zero has no input. */
static fmu_answer fmu_scene_relist(fmu_plant *p, fmu_text text)
{
  const int n = p->n_exported;
  char unit[FMU_SCENE_VARIABLES][40];
  memcpy(unit, p->unit, sizeof unit);
  fmu_scene_list(p, &p->s);
  for (int k = 0; k < n || k < p->n_variable; k++) {
    if (k >= n || k >= p->n_variable || strcmp(p->exported[k], p->name[k]) != 0) {
      snprintf(text, sizeof(fmu_text),
               "with these parameters the scene has other variables than the FMU (%s): export it with them",
               k < n ? p->exported[k] : p->name[k]);
      memcpy(p->name, p->exported, sizeof p->name); /* variables of the instance are named by these */
      memcpy(p->unit, unit, sizeof unit);
      return FMU_ERROR;
    }
  }
  return FMU_OK;
}

/* Bodies of these parameters. Nothing of the inputs is in what is built. */
static fmu_answer fmu_scene_make(fmu_plant *p, const double *parameter, double step, fmu_text text)
{
  fmu_answer answer = fmu_scene_read(p, p->path, parameter, step, text);
  answer = answer ? answer : fmu_scene_relist(p, text);
  if (answer != FMU_OK) {
    return answer;
  }
  if (p->used) {
    clear_memory(&engine, offsetof(struct scene_engine, body));
  }
  p->used = 1;
  scene_warn_bodies(&p->s, p->options.warn);
  if (scene_build(&p->s, &p->options)) {
    return fmu_scene_said(text, FMU_ERROR, p->s.message);
  }
  p->spin = automatic.spin;
  p->acceleration = automatic.acceleration;
  memcpy(p->advice, automatic.advice, sizeof p->advice);
  for (int k = 0; k < p->s.n_parameter; k++) {
    p->built[k] = parameter[k];
  }
  p->built_step = step;
  p->made = 1;
  p->begun = 0;
  return FMU_OK;
}

static double *fmu_scene_added(const fmu_scene_input *in)
{
  return in->is_rate ? &in->f->added_rate : &in->f->added;
}

/* The scene as the values have it, in this thread. */
static fmu_answer fmu_plant_prepare(fmu_plant *p, const fmu_values *v, fmu_text text)
{
  double parameter[SCENE_PARAMETERS] = {0}, step = 0;
  int same = p->made, n = 0;
  fmu_scene_here(p);
  for (int k = 0; k < v->n; k++) {
    const fmu_variable *const one = &v->variable[k];
    if (one->kind == FMU_SCENE_PARAMETER) {
      parameter[n++] = v->value[k];
    }
    step = one->kind == FMU_SCENE_STEP ? v->value[k] : step;
  }
  for (int k = 0; k < n; k++) {
    same = same && !(parameter[k] < p->built[k] || parameter[k] > p->built[k]);
  }
  if (!same || step < p->built_step || step > p->built_step) {
    fmu_answer answer;
    fmu_scene_wait();
    answer = fmu_scene_make(p, parameter, step, text);
    fmu_scene_done();
    if (answer != FMU_OK) {
      return answer;
    }
  }
  for (int k = 0; k < p->n_input; k++) { /* behind time */
    *fmu_scene_added(&p->input[k]) = v->value[1 + k] / p->input[k].size;
  }
  return FMU_OK;
}

/* What moves the base goes on for so long: what was set is what is there now. */
static void fmu_scene_moved(const fmu_plant *p, const fmu_values *v, double after)
{
  for (int k = 0; k < p->n_input; k++) {
    if (p->input[k].is_rate) {
      v->value[k] += after * v->value[1 + k];
    }
  }
}

/* The parts of a state that this scene has. */
static inline int fmu_plant_spans(const fmu_plant *p, fmu_span *span, fmu_plant_state *state)
{
  const scene *const s = &p->s;
  fb_system_state *const system = &state->of.system;
  fb_exact_state *const x = &state->of.exact;
  const size_t bodies = (size_t)s->n_body, joints = bodies + (size_t)s->n_loop;
  const size_t cells = (size_t)(s->is_exact ? s->exact.n_all : 0), nodes = cells + 1, real = sizeof(fb_real);
  const size_t hinges = (size_t)(s->is_exact ? s->exact.desc.n_joint : 0);
  const size_t head = offsetof(fmu_plant_state, remembered) + (size_t)s->n_remembered * sizeof state->remembered[0];
  const fmu_span first = {state, head}, alone = {&state->of.body, sizeof state->of.body};
  const fmu_span of_system[] = {
      {system->link, bodies * sizeof system->link[0]},   {&system->motor_work, real},
      {state->origin, joints * sizeof state->origin[0]}, {system->mode, joints * sizeof system->mode[0]},
      {system->hold, joints * sizeof system->hold[0]},   {system->hold_quat, joints * sizeof system->hold_quat[0]}};
  const size_t whole = sizeof(fb_exact_state) - offsetof(fb_exact_state, known);
  const fmu_span of_exact[] = {{x->base_position, 7 * real},
                               {x->r, 3 * nodes * real},
                               {x->quat, 4 * nodes * real},
                               {x->strain, 6 * cells * real},
                               {x->momentum, 6 * cells * real},
                               {x->velocity, 6 * nodes * real},
                               {x->strain_rate, 6 * cells * real},
                               {x->momentum_rate, 6 * cells * real},
                               {x->velocity_rate, 6 * nodes * real},
                               {x->angle, hinges * real},
                               {x->angle_rate, hinges * real},
                               {x->V[0], 6 * nodes * real},
                               {x->V[1], 6 * nodes * real},
                               {x->V[2], 6 * nodes * real},
                               {x->stress[0], 6 * cells * real},
                               {x->stress[1], 6 * cells * real},
                               {x->stress[2], 6 * cells * real},
                               {x->force, 6 * nodes * real},
                               {x->reaction, 6 * nodes * real},
                               {x->offset, 6 * cells * real},
                               {&x->known, whole}};
  const fmu_span *const rest = s->is_exact ? of_exact : scene_is_system(s) ? of_system : &alone;
  const int n = (int)(s->is_exact          ? sizeof of_exact / sizeof of_exact[0]
                      : scene_is_system(s) ? sizeof of_system / sizeof of_system[0]
                                           : 1);
  span[0] = first;
  memcpy(span + 1, rest, (size_t)n * sizeof *span);
  return n + 1;
}

/* The start, and what is chosen with it. */
static fmu_answer fmu_scene_begin(fmu_plant *p, fmu_text text)
{
  scene *const s = &p->s;
  fb_status status;
  for (int k = 0; k < p->n_input; k++) {
    p->input[k].f->added_from = 0;
  }
  fmu_scene_wait();
  status = scene_start(s);
  if (status != FB_OK) {
    scene_no_start(s, status);
  }
  fmu_scene_done();
  if (status != FB_OK) {
    return fmu_scene_said(text, FMU_ERROR, s->message);
  }
  scene_clock_init(s, scene_rows(s));
  if (s->duration > 0) {
    fmu_scene_wait();
    automatic.spin = p->spin;
    automatic.acceleration = p->acceleration;
    memcpy(automatic.advice, p->advice, sizeof p->advice);
    scene_choose(s);
    fmu_scene_done();
  }
  if (s->duration > 0 && scene_check_steps(s, &p->options)) {
    return fmu_scene_said(text, FMU_ERROR, s->message);
  }
  engine.by_step = 0;
  p->run.event = p->run.halved = 0;
  p->begun = 1;
  return FMU_OK;
}

/* What was built anew, for a state that was saved, starts as the scene does by itself; the state takes its place. */
static fmu_answer fmu_scene_begin_alone(fmu_plant *p, fmu_text text)
{
  double added[FMU_SCENE_INPUTS];
  fmu_answer answer;
  for (int k = 0; k < p->n_input; k++) {
    added[k] = *fmu_scene_added(&p->input[k]);
    *fmu_scene_added(&p->input[k]) = 0;
  }
  answer = fmu_scene_begin(p, text);
  for (int k = 0; k < p->n_input; k++) {
    *fmu_scene_added(&p->input[k]) = added[k];
  }
  return answer;
}

/* A state into what runs, and back. */
static fmu_answer fmu_scene_load(fmu_plant *p, const fmu_plant_state *state, fmu_text text)
{
  const size_t known = (size_t)p->s.n_remembered * sizeof remembered[0];
  const fmu_answer answer = p->begun ? FMU_OK : fmu_scene_begin_alone(p, text);
  if (answer != FMU_OK) {
    return answer;
  }
  if (engine.integrator != state->integrator) {
    engine.by_step = 0;
  }
  engine.integrator = state->integrator;
  timing.interval = state->interval;
  timing.slack = 1e-9 * timing.interval;
  timing.longest = state->longest;
  timing.part = state->part;
  p->run.event = state->event;
  p->run.halved = state->halved;
  memcpy(engine.origin, state->origin, sizeof engine.origin);
  memcpy(controlling, state->controlling, sizeof state->controlling);
  memcpy(remembered, state->remembered, known);
  for (int k = 0; k < p->n_input; k++) {
    p->input[k].f->added_from = state->time;
  }
  if (p->s.is_exact) {
    exact_run.state = state->of.exact;
  } else if (scene_is_system(&p->s)) {
    engine.system_state = state->of.system;
  } else {
    engine.state = state->of.body;
  }
  return FMU_OK;
}

static void fmu_scene_store(fmu_plant *p, fmu_plant_state *state)
{
  const size_t known = (size_t)p->s.n_remembered * sizeof remembered[0];
  state->integrator = engine.integrator;
  state->interval = timing.interval;
  state->longest = timing.longest;
  state->part = timing.part;
  state->event = p->run.event;
  state->halved = p->run.halved;
  memcpy(state->origin, engine.origin, sizeof engine.origin);
  memcpy(state->controlling, controlling, sizeof state->controlling);
  memcpy(state->remembered, remembered, known);
  if (p->s.is_exact) {
    state->of.exact = exact_run.state;
  } else if (scene_is_system(&p->s)) {
    state->of.system = engine.system_state;
  } else {
    state->of.body = engine.state;
  }
}

/* All but the bodies, of which nothing is used that was not written. */
static inline void fmu_plant_clear(fmu_plant *p)
{
  clear_memory(p, offsetof(fmu_plant, s) + offsetof(scene, body));
  clear_memory(&p->clock, sizeof p->clock);
  clear_memory(p->controller, sizeof p->controller);
  clear_memory(p->remembered, sizeof p->remembered);
  clear_memory(&p->moving, offsetof(struct scene_engine, body));
  clear_memory(&p->bending, sizeof p->bending);
}

/* The scene that was read is what was exported. */
static void fmu_scene_opened(fmu_plant *p)
{
  fmu_scene_list(p, &p->s);
  memcpy(p->exported, p->name, sizeof p->exported);
  p->n_exported = p->n_variable;
  p->n_parameter = p->s.n_parameter;
  for (int k = 0; k < p->n_parameter; k++) {
    strcpy(p->parameter[k], p->s.parameter[k].name);
  }
}

/* ---- what the core asks for */

static fmu_answer fmu_plant_open(fmu_plant *p, const char *resources, fmu_text text)
{
  fmu_answer answer;
  fmu_scene_wait();
  answer = fmu_scene_open(p, resources, text);
  answer = answer ? answer : fmu_scene_read(p, p->path, NULL, 0, text);
  fmu_scene_done();
  if (answer == FMU_OK) {
    fmu_scene_opened(p);
  }
  (void)scene_run; /* it runs a scene from end to end; here somebody else has the clock */
  return answer;
}

static const char *fmu_plant_token(const fmu_plant *p)
{
  return p->token;
}

static int fmu_plant_variables(const fmu_plant *p, fmu_variable *list)
{
  memcpy(list, p->variable, (size_t)p->n_variable * sizeof *list);
  return p->n_variable;
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
  fmu_answer answer = fmu_plant_prepare(p, v, text);
  answer = answer ? answer : fmu_scene_begin(p, text);
  if (answer == FMU_OK) {
    clear_memory(state, sizeof *state);
    fmu_scene_store(p, state);
  }
  return answer;
}

/* From start to last, which is `interval` away. */
static fb_status fmu_scene_interval(fmu_plant *p, fmu_plant_state *state, double start, double last, double interval,
                                    char when[96])
{
  timing.interval = interval;
  timing.slack = 1e-9 * interval;
  state->time = last;
  return scene_interval(&p->s, &p->run, start, last, when);
}

static int fmu_scene_same(double a, double b, double scale)
{
  return fabs(a - b) <= FMU_SAME * scale;
}

/* t, or the row that it is but for rounding. */
static double fmu_scene_row(double t, double row)
{
  const double at = floor(t / row + 0.5) * row;
  return fmu_scene_same(at, t, row) ? at : t;
}

/* [s] that are nothing */
static double fmu_scene_slack(const fmu_plant *p)
{
  return FMU_SAME * p->s.duration / (double)p->clock.rows;
}

/* Is an event at *t, but for rounding? Then it is *t. */
static int fmu_scene_is_event(const fmu_plant *p, double *t)
{
  for (int k = 0; k < p->s.n_event; k++) {
    if (fabs(*t - p->s.event[k].t) <= fmu_scene_slack(p)) {
      *t = p->s.event[k].t;
      return 1;
    }
  }
  return 0;
}

/* A communication step. Where it is a number of rows of the scene, those, to the last bit. Else one interval of its
   own, from a multiple of it to the next where the time is one: the same steps in each. */
static fb_status fmu_scene_advance(fmu_plant *p, fmu_plant_state *state, double length, char when[96])
{
  const double row = p->s.duration / (double)timing.rows, many = floor(length / row + 0.5);
  const double at = floor(state->time / row + 0.5);
  double unit, start, last;
  fb_status status = FB_OK;
  if (many >= 1 && fmu_scene_same(length, many * row, length) && fmu_scene_same(state->time, at * row, row)) {
    for (double k = 0; k < many && status == FB_OK; k++) {
      status = fmu_scene_interval(p, state, (at + k) * row, (at + k + 1) * row, row, when);
    }
    return status;
  }
  last = state->time + length;
  start = state->time;
  if (fmu_scene_is_event(p, &last) || fmu_scene_is_event(p, &start)) {
    last = fmu_scene_row(last, row);
    return fmu_scene_interval(p, state, start, last, last - start, when);
  }
  unit = fmu_scene_same(length, state->unit, length) ? state->unit : length;
  state->unit = unit;
  start = floor(state->time / unit + 0.5);
  if (fmu_scene_same(state->time, start * unit, unit)) {
    return fmu_scene_interval(p, state, start * unit, (start + 1) * unit, unit, when);
  }
  last = fmu_scene_row(state->time + length, row);
  return fmu_scene_interval(p, state, state->time, last, last - state->time, when);
}

/* Steps of a communication step, at least: one of each row, and of what acts. Beyond FMU_MOST_STEPS: not of all. */
static double fmu_scene_steps(const fmu_plant *p, double from, double length)
{
  const double rows = length * (double)timing.rows / p->s.duration, last = from + length;
  double count = 0, t = from;
  timing.interval = length;
  timing.slack = 1e-9 * length;
  while (t < last && count <= FMU_MOST_STEPS) {
    const scene_piece piece = scene_piece_from(&p->s, from, last, t);
    count += piece.steps;
    t = piece.end;
  }
  return fmax(count, floor(rows));
}

static fmu_answer fmu_plant_step(fmu_plant *p, fmu_plant_state *state, const fmu_values *v, double from, double length,
                                 fmu_text text)
{
  fmu_answer answer = fmu_plant_prepare(p, v, text);
  char when[96] = "at the start";
  fb_status status;
  double steps;
  (void)from;
  answer = answer ? answer : fmu_scene_load(p, state, text);
  if (answer != FMU_OK) {
    return answer;
  }
  steps = fmu_scene_steps(p, state->time, length);
  if (!(steps <= FMU_MOST_STEPS)) {
    snprintf(text, sizeof(fmu_text), "a communication step of %g s takes %.3g steps or more; %d at most", length, steps,
             FMU_MOST_STEPS);
    return FMU_ERROR;
  }
  status = fmu_scene_advance(p, state, length, when);
  fmu_scene_store(p, state);
  if (status != FB_OK) {
    scene_failed(&p->s, when, status);
    return fmu_scene_said(text, FMU_DISCARD, p->s.message);
  }
  fmu_scene_moved(p, v, length);
  return FMU_OK;
}

/* ---- events: latches. They are in the order of time */

static inline double fmu_plant_until(const fmu_plant *p, const fmu_plant_state *state)
{
  for (int k = state->event; k < p->s.n_event; k++) {
    if (p->s.event[k].t - state->time > fmu_scene_slack(p)) {
      return p->s.event[k].t - state->time;
    }
  }
  return HUGE_VAL;
}

static inline int fmu_plant_is_due(const fmu_plant *p, const fmu_plant_state *state)
{
  return state->event < p->s.n_event && p->s.event[state->event].t - state->time <= fmu_scene_slack(p);
}

static inline int fmu_plant_has_events(const fmu_plant *p)
{
  return p->s.n_event > 0;
}

static inline fmu_answer fmu_plant_happen(fmu_plant *p, fmu_plant_state *state, const fmu_values *v, fmu_text text)
{
  fb_status status;
  fmu_answer answer = fmu_plant_prepare(p, v, text);
  answer = answer ? answer : fmu_scene_load(p, state, text);
  if (answer != FMU_OK) {
    return answer;
  }
  status = scene_happen(&p->s, &p->run.event, state->time);
  fmu_scene_store(p, state);
  if (status != FB_OK) {
    scene_failed(&p->s, "event", status);
    return fmu_scene_said(text, FMU_ERROR, p->s.message);
  }
  return FMU_OK;
}

/* As that of a body; and the step is short beside springs and functions of time. */
static inline fmu_answer fmu_plant_instant(fmu_plant *p, double *h, const fmu_plant_state *state, const fmu_values *v,
                                           fmu_text text)
{
  fmu_answer answer = fmu_plant_prepare(p, v, text);
  answer = answer ? answer : fmu_scene_load(p, state, text);
  if (answer == FMU_OK && p->s.is_exact) {
    answer = fmu_scene_said(text, FMU_ERROR, "an exact beam has no derivatives of outputs by time");
  }
  if (answer == FMU_OK) {
    const fb_real limit = scene_is_system(&p->s) ? fb_system_rk4_limit(&engine.system, engine.body, 0, 0)
                                                 : fb_rk4_limit(&engine.body[0], 0, 0);
    *h = fmin(fmin(FMU_INSTANT, (double)limit / 400), timing.longest / 10);
  }
  return answer;
}

/* Commands stay as they are. */
static inline fmu_answer fmu_plant_ahead(fmu_plant *p, fmu_plant_state *state, const fmu_values *v, double h,
                                         fmu_text text)
{
  const scene *const s = &p->s;
  const double t = state->time, side = t + 0.5 * h;
  fb_status status = FB_OK;
  fmu_answer answer = fmu_plant_prepare(p, v, text);
  answer = answer ? answer : fmu_scene_load(p, state, text);
  if (answer != FMU_OK) {
    return answer;
  }
  for (int k = 0; k < 3; k++) {
    if (scene_is_system(s)) {
      system_input(s, &engine.system_at[k], t + 0.5 * k * h, side);
    } else {
      single_input(s, &engine.at[k], t + 0.5 * k * h, side);
    }
  }
  if (scene_is_system(s)) {
    const fb_system_input *const in = engine.system_at;
    status = fb_system_rk4_step(&engine.system, engine.body, &engine.system_state, &engine.system_work, &in[0], &in[1],
                                &in[2], (fb_real)h);
  } else {
    const fb_input *const in = engine.at;
    status = fb_rk4_step(&engine.body[0], &engine.state, &engine.by.work.rk4, &in[0], &in[1], &in[2], (fb_real)h);
  }
  fmu_scene_store(p, state);
  state->time = t + h;
  if (status != FB_OK) {
    scene_failed(&p->s, "derivatives", status);
    return fmu_scene_said(text, FMU_ERROR, p->s.message);
  }
  fmu_scene_moved(p, v, h);
  return FMU_OK;
}

static fmu_answer fmu_plant_outputs(fmu_plant *p, const fmu_plant_state *state, const fmu_values *v, fmu_text text)
{
  scene *const s = &p->s;
  fmu_answer answer = fmu_plant_prepare(p, v, text);
  fb_status status;
  answer = answer ? answer : fmu_scene_load(p, state, text);
  if (answer != FMU_OK) {
    return answer;
  }
  status = scene_look(s, state->time);
  for (int k = 0; k < s->n_output && status == FB_OK; k++) { /* behind time and inputs */
    v->value[1 + p->n_input + k] = scene_value(s, &s->output[k]);
  }
  if (status != FB_OK) {
    scene_failed(s, "outputs", status);
    return fmu_scene_said(text, FMU_ERROR, s->message);
  }
  return FMU_OK;
}
#endif
