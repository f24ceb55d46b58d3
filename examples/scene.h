/* scene.h - a scene from a text file: bodies, joints, loads, what is to be written and measured. README.md, "Scenes",
   lists the words. Everything is static, and may be called again and again; nothing exits or prints:

     static scene s;
     const scene_setting set[] = {{"spin", 6.0}};
     const scene_options quiet = {0};
     if (scene_read(&s, "scenes/spinup.txt", set, 1) != 0 || scene_run(&s, &quiet) != 0) {
       puts(s.message); // file, line, reason
     }
     s.measured[k] // of s.measure[k].label, in the order of the file

   scene_read is here, scene_run in scene_run.h, which includes this file. */
#ifndef SCENE_H
#define SCENE_H
#define FB_MAX_MODES 24
#define FB_MAX_NODES 24
#define FB_MAX_LOADS 16
#define FB_MAX_ELEMENTS 40
#define FB_MAX_STATIONS 200
#define FB_MAX_STRAINS 60
#define FB_MAX_LOOPS 4
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#include "model.h"
#include "function.h"

#define SCENE_NODES 11 /* of a body, with names; the rest is for drawing */
#define SCENE_PARAMETERS 64
#define SCENE_OUTPUTS 64
#define SCENE_MEASURES 64
#define SCENE_LOADS 64
#define SCENE_MOTIONS 12
#define SCENE_GAUGES 4

typedef struct scene_setting { /* a parameter that is not to have the file's value */
  const char *name;
  double value;
} scene_setting;

typedef struct scene_body {
  char name[TEXT_NAME];
  int line; /* where it begins */
  model_kind kind;
  fb_shape shape; /* of all its modes */
  fb_body_desc level;
  int n_node; /* with node 0; further ones of the shape are drawn */
  char node_name[FB_MAX_NODES][TEXT_NAME];
  double tolerance; /* of `auto`; 0: effects as given */
  double position[3], attitude[4], velocity[3], spin[3], q[FB_MAX_MODES], q_dot[FB_MAX_MODES]; /* at the start */
  int n_gauge;
  char gauge_name[SCENE_GAUGES][TEXT_NAME];
  fb_gauge gauge[SCENE_GAUGES];
} scene_body;

typedef struct scene_load { /* vector times function */
  int body, node, torque;
  fb_axes axes;
  double vector[3];
  function f;
} scene_load;

typedef struct scene_motion { /* of a prescribed base, body axes */
  int rate;                   /* [rad/s], else a velocity [m/s] */
  double vector[3];
  function f;
} scene_motion;

typedef enum scene_place { SCENE_AT_NODE, SCENE_AT_BODY, SCENE_AT_MODE, SCENE_AT_GAUGE, SCENE_AT_ALL } scene_place;

typedef enum scene_quantity {
  SCENE_DISPLACEMENT,
  SCENE_ROTATION,
  SCENE_POSITION,
  SCENE_VELOCITY,
  SCENE_ACCELERATION,
  SCENE_RATE,
  SCENE_RATE_DOT,
  SCENE_SPECIFIC_FORCE,
  SCENE_GYRO,
  SCENE_SPIN,
  SCENE_ATTITUDE,
  SCENE_REACTION_FORCE,
  SCENE_REACTION_TORQUE,
  SCENE_MODE,
  SCENE_MODE_RATE,
  SCENE_STRAIN,
  SCENE_ENERGY,
  SCENE_MOMENTUM,
  SCENE_ANGULAR_MOMENTUM
} scene_quantity;

static const struct scene_quantity_row {
  const char *name, *unit;
  scene_place place;
  const char *axes[5];
} scene_quantities[] = {{"displacement", "m", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"rotation", "rad", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"position", "m", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"velocity", "m/s", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"acceleration", "m/s^2", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"rate", "rad/s", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"rate_dot", "rad/s^2", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"specific_force", "m/s^2", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"gyro", "rad/s", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"spin", "rad/s", SCENE_AT_BODY, {"x", "y", "z"}},
                        {"attitude", "-", SCENE_AT_BODY, {"w", "x", "y", "z"}},
                        {"reaction_force", "N", SCENE_AT_BODY, {"x", "y", "z"}},
                        {"reaction_torque", "N m", SCENE_AT_BODY, {"x", "y", "z"}},
                        {"mode", "sqrt(kg) m", SCENE_AT_MODE, {NULL}},
                        {"mode_rate", "sqrt(kg) m/s", SCENE_AT_MODE, {NULL}},
                        {"strain", "-", SCENE_AT_GAUGE, {NULL}},
                        {"energy", "J", SCENE_AT_ALL, {"total", "kinetic", "strain", "gravity"}},
                        {"momentum", "N s", SCENE_AT_ALL, {"x", "y", "z"}},
                        {"angular_momentum", "N m s", SCENE_AT_ALL, {"x", "y", "z"}}};
#define SCENE_QUANTITIES ((int)(sizeof scene_quantities / sizeof scene_quantities[0]))

typedef struct scene_output {
  char label[TEXT_NAME];
  scene_quantity quantity;
  int body, at, axis; /* at: node, mode or gauge */
} scene_output;

typedef enum scene_kind { SCENE_MAX, SCENE_MIN, SCENE_MEAN, SCENE_RMS, SCENE_FINAL } scene_kind;
static const char *const scene_kinds[] = {"max", "min", "mean", "rms", "final", NULL};

typedef struct scene_measure {
  char label[TEXT_NAME];
  scene_kind kind;
  int output;
  double after; /* [s] */
} scene_measure;

typedef struct scene {
  char message[TEXT_MESSAGE], path[512];
  int n_parameter;
  text_named parameter[SCENE_PARAMETERS];
  double duration, interval, step; /* [s]; step 0: chosen */
  fb_scheme scheme;
  double gravity[3];
  int trim; /* starts in its steady state */
  int n_body, n_load, n_motion, n_output, n_measure;
  scene_body body[FB_MAX_BODIES];
  scene_load load[SCENE_LOADS];
  scene_motion motion[SCENE_MOTIONS];
  scene_output output[SCENE_OUTPUTS];
  scene_measure measure[SCENE_MEASURES];
  double measured[SCENE_MEASURES]; /* by scene_run */
  function_tables tables;
  int n_seen; /* words that may be there once */
  char seen[16][TEXT_NAME];
  const scene_setting *set;
  int n_set;
} scene;

/* A reason in the scene's message; returns 1. */
static int scene_fail(scene *s, const char *format, ...)
{
  va_list list;
  const int n = snprintf(s->message, sizeof s->message, "%.400s: ", s->path);
  va_start(list, format);
  vsnprintf(s->message + n, sizeof s->message - (size_t)n, format, list);
  va_end(list);
  return 1;
}

/* ---- names */

/* parameter NAME VALUE [what it is] */
static void scene_read_parameter(text_file *t, scene *s)
{
  text_named *const p = &s->parameter[s->n_parameter];
  if (s->n_parameter == SCENE_PARAMETERS) {
    text_fail(t, "more than %d parameters", SCENE_PARAMETERS);
    return;
  }
  text_name(t, "a parameter", p->name);
  for (int k = 0; k < s->n_parameter; k++) {
    if (strcmp(s->parameter[k].name, p->name) == 0) {
      text_fail(t, "two parameters have the name %s", p->name);
    }
  }
  p->value = text_number(t, p->name);
  for (int k = 0; k < s->n_set; k++) {
    if (strcmp(s->set[k].name, p->name) == 0) {
      p->value = s->set[k].value;
    }
  }
  while (text_more(t)) {
    (void)text_word(t); /* unit, meaning */
  }
  t->named = s->parameter;
  t->n_named = ++s->n_parameter;
}

/* Node, or -1 after a complaint. */
static int scene_node_of(text_file *t, const scene_body *body, const char *name)
{
  char *end;
  const long number = strtol(name, &end, 10);
  if (end != name && !*end && number >= 0 && number < body->n_node) {
    return (int)number;
  }
  for (int k = 1; k < body->n_node; k++) {
    if (strcmp(body->node_name[k], name) == 0) {
      return k;
    }
  }
  if (strcmp(name, "origin") == 0) {
    return 0;
  }
  text_fail(t, "body %s has no node %s", body->name, name);
  return -1;
}

/* BODY or BODY.PART; part: what is behind the point, empty if there is none. */
static int scene_read_body_name(text_file *t, const scene *s, char part[TEXT_NAME])
{
  const char *const word = text_word(t);
  const size_t n = word ? strcspn(word, ".") : 0;
  part[0] = 0;
  if (!word || strlen(word) >= TEXT_NAME) {
    text_fail(t, word ? "a name is too long: %s" : "the name of a body is missing", word);
    return 0;
  }
  strcpy(part, word[n] ? word + n + 1 : "");
  for (int k = 0; k < s->n_body; k++) {
    if (strlen(s->body[k].name) == n && strncmp(s->body[k].name, word, n) == 0) {
      return k;
    }
  }
  text_fail(t, "no body has the name %.*s", (int)n, word);
  return 0;
}

/* BODY.NODE, or BODY for its origin. */
static void scene_read_node(text_file *t, const scene *s, int *body, int *node)
{
  char part[TEXT_NAME];
  *body = scene_read_body_name(t, s, part);
  *node = t->failed || !part[0] ? 0 : scene_node_of(t, &s->body[*body], part);
}

/* ---- bodies */

/* gauge NAME X Y Z: kept until the body's modes are known */
typedef struct scene_gauge_line {
  int n;
  double x[SCENE_GAUGES][3];
} scene_gauge_line;

static void scene_read_gauge(text_file *t, scene_body *body, scene_gauge_line *gauges)
{
  if (gauges->n == SCENE_GAUGES) {
    text_fail(t, "more than %d gauges", SCENE_GAUGES);
    return;
  }
  text_name(t, "a gauge", body->gauge_name[gauges->n]);
  text_vector(t, "place along the beam, y and z off its line", gauges->x[gauges->n++], 3);
}

/* Words of a body that are the scene's; 0 if it is none of them. */
static int scene_read_start(text_file *t, scene_body *body, const char *word)
{
  if (strcmp(word, "start_position") == 0) {
    text_vector(t, word, body->position, 3);
  } else if (strcmp(word, "start_attitude") == 0) {
    text_vector(t, word, body->attitude, 4);
  } else if (strcmp(word, "start_velocity") == 0) {
    text_vector(t, word, body->velocity, 3);
  } else if (strcmp(word, "start_spin") == 0) {
    text_vector(t, word, body->spin, 3);
  } else if (strcmp(word, "start_mode") == 0) {
    const int k = text_whole(t, "mode", 1, FB_MAX_MODES) - 1;
    body->q[k] = text_number(t, "its coordinate");
    body->q_dot[k] = text_more(t) ? text_number(t, "its rate") : 0;
  } else if (strcmp(word, "auto") == 0) {
    body->tolerance = text_number(t, "tolerance");
    if (!t->failed && !(body->tolerance > 0)) {
      text_fail(t, "a tolerance must be greater than 0");
    }
  } else {
    return 0;
  }
  text_end_of_line(t);
  return 1;
}

/* Nodes along a beam, to draw it by. */
static fb_status scene_add_drawn(const scene_body *body)
{
  const int n = FB_MAX_NODES - body->n_node - 1;
  fb_status status = FB_OK;
  for (int k = 0; k <= n && body->kind == MODEL_BEAM && status == FB_OK; k++) {
    int at;
    status = fb_shape_add_beam_node(&model_shape, &at, 0, &model_beam, &model_modes,
                                    model_beam.start[model_beam.desc.n_element] * (fb_real)k / (fb_real)n);
  }
  return status;
}

/* The shape of the description that was read. */
static void scene_build_body(text_file *t, const scene *s, scene_body *body, const scene_gauge_line *gauges)
{
  const char *what;
  fb_status status = model_build_shape(&what);
  body->kind = model.kind;
  body->level = model.level;
  body->n_node = model_shape.n_node;
  body->n_gauge = gauges->n;
  memcpy(body->node_name, model.node_name, sizeof body->node_name);
  if (status == FB_OK && body->n_node > SCENE_NODES + 1) {
    text_fail(t, "more than %d nodes", SCENE_NODES);
  }
  if (gauges->n > 0 && body->kind != MODEL_BEAM) {
    text_fail(t, "gauges are on beams");
    return;
  }
  for (int k = 0; k < gauges->n && status == FB_OK; k++) {
    what = "a gauge";
    status = fb_gauge_init(&body->gauge[k], 0, &model_beam, &model_modes, (fb_real)gauges->x[k][0],
                           (fb_real)gauges->x[k][1], (fb_real)gauges->x[k][2]);
  }
  if (status == FB_OK) {
    status = scene_add_drawn(body);
  }
  if (status != FB_OK) {
    text_fail(t, "%s: %s", what, fb_status_string(status));
  }
  if (fabs(s->gravity[0]) + fabs(s->gravity[1]) + fabs(s->gravity[2]) > 0) {
    body->level.effects |= FB_EFFECT_GRAVITY;
    for (int i = 0; i < 3; i++) {
      body->level.gravity[i] = (fb_real)s->gravity[i];
    }
  }
  body->shape = model_shape;
}

/* The file that another one names, from that one's folder. */
static void scene_beside(char path[512], const char *from, const char *name)
{
  const char *const slash = strrchr(from, '/');
  snprintf(path, 512, "%.*s%s", name[0] == '/' || !slash ? 0 : (int)(slash - from + 1), from, name);
}

/* The lines of another file. */
static void scene_read_model(text_file *t, const scene *s)
{
  char path[512];
  text_file other;
  const char *const name = text_word(t);
  if (!name) {
    text_fail(t, "the name of a file is missing");
    return;
  }
  scene_beside(path, s->path, name);
  if (text_open(&other, t->program, path)) {
    other.message = t->message;
    other.named = t->named;
    other.n_named = t->n_named;
    model_lines(&other);
  } else {
    text_fail(t, "%s: %s", path, strerror(errno));
  }
  t->failed |= other.failed;
  text_close(&other);
}

/* body NAME beam|component|rigid, its lines, end; or body NAME file FILE, further lines, end */
static void scene_read_body(text_file *t, scene *s)
{
  static const char *const kinds[] = {"beam", "component", "rigid", "file", NULL};
  scene_body *const body = &s->body[s->n_body];
  scene_gauge_line gauges = {0};
  const int begin = t->line;
  int kind, ended = 0;
  if (s->n_body == FB_MAX_BODIES) {
    text_fail(t, "more than %d bodies", FB_MAX_BODIES);
    return;
  }
  memset(body, 0, sizeof *body);
  body->attitude[0] = 1;
  body->line = begin;
  text_name(t, "a body", body->name);
  for (int k = 0; k < s->n_body; k++) {
    if (strcmp(s->body[k].name, body->name) == 0) {
      text_fail(t, "two bodies have the name %s", body->name);
    }
  }
  kind = text_choice(t, "a body", kinds);
  if (kind < 3) {
    model_begin((model_kind)kind);
  } else {
    scene_read_model(t, s);
    model.n_seen = 0; /* lines here may change what it says */
  }
  text_end_of_line(t);
  while (!ended && text_line(t)) {
    const char *const word = text_word(t);
    ended = strcmp(word, "end") == 0;
    if (strcmp(word, "gauge") == 0) {
      scene_read_gauge(t, body, &gauges);
    } else if (!ended && !scene_read_start(t, body, word)) {
      model_line(t, word);
    }
  }
  if (!ended) {
    text_fail(t, "body %s of line %d wants a line `end`", body->name, begin);
  }
  t->line = begin; /* what is missing has no line of its own */
  model_check(t);
  if (!t->failed) {
    scene_build_body(t, s, body, &gauges);
    s->n_body++;
  }
}

/* ---- loads and the motion of the base */

/* Forces or torques with that many numbers. */
static int scene_read_force_or_torque(text_file *t, double vector[3])
{
  static const char *const kinds[] = {"force", "torque", NULL};
  const int torque = text_choice(t, "a load", kinds);
  text_vector(t, kinds[torque], vector, 3);
  return torque;
}

/* What follows a vector: a function, or nothing, for a constant. */
static function scene_read_function(text_file *t, scene *s)
{
  function f = {FUNCTION_CONSTANT, 1, 0, 0, 0, 0, 0, 0};
  return text_more(t) ? function_read(t, &s->tables, s->path) : f;
}

/* load BODY.NODE dead|follower|base force|torque X Y Z [FUNCTION] */
static void scene_read_load(text_file *t, scene *s)
{
  static const char *const axes[] = {"dead", "follower", "base", NULL};
  scene_load *const load = &s->load[s->n_load];
  if (s->n_load == SCENE_LOADS) {
    text_fail(t, "more than %d loads", SCENE_LOADS);
    return;
  }
  scene_read_node(t, s, &load->body, &load->node);
  load->axes = (fb_axes)text_choice(t, "axes of a load", axes);
  load->torque = scene_read_force_or_torque(t, load->vector);
  load->f = scene_read_function(t, s);
  s->n_load++;
}

/* motion velocity|rate X Y Z [FUNCTION] */
static void scene_read_motion(text_file *t, scene *s)
{
  static const char *const kinds[] = {"velocity", "rate", NULL};
  scene_motion *const motion = &s->motion[s->n_motion];
  if (s->n_motion == SCENE_MOTIONS) {
    text_fail(t, "more than %d lines of motion", SCENE_MOTIONS);
    return;
  }
  motion->rate = text_choice(t, "motion of the base", kinds);
  text_vector(t, kinds[motion->rate], motion->vector, 3);
  motion->f = scene_read_function(t, s);
  s->n_motion++;
}

/* ---- what is wanted */

static void scene_read_gauge_name(text_file *t, const scene *s, scene_output *output)
{
  char part[TEXT_NAME];
  output->body = scene_read_body_name(t, s, part);
  for (int k = 0; k < s->body[output->body].n_gauge; k++) {
    if (strcmp(s->body[output->body].gauge_name[k], part) == 0) {
      output->at = k;
      return;
    }
  }
  text_fail(t, "body %s has no gauge %s", s->body[output->body].name, part);
}

/* output LABEL QUANTITY PLACE AXIS */
static void scene_read_output(text_file *t, scene *s)
{
  const char *names[SCENE_QUANTITIES + 1] = {NULL};
  scene_output *const output = &s->output[s->n_output];
  char part[TEXT_NAME];
  if (s->n_output == SCENE_OUTPUTS) {
    text_fail(t, "more than %d outputs", SCENE_OUTPUTS);
    return;
  }
  for (int k = 0; k < SCENE_QUANTITIES; k++) {
    names[k] = scene_quantities[k].name;
  }
  text_name(t, "an output", output->label);
  for (int k = 0; k < s->n_output; k++) {
    if (strcmp(s->output[k].label, output->label) == 0) {
      text_fail(t, "two outputs have the name %s", output->label);
    }
  }
  output->quantity = (scene_quantity)text_choice(t, "an output", names);
  switch (scene_quantities[output->quantity].place) {
  case SCENE_AT_NODE:
    scene_read_node(t, s, &output->body, &output->at);
    break;
  case SCENE_AT_BODY:
    output->body = scene_read_body_name(t, s, part);
    break;
  case SCENE_AT_MODE:
    output->body = scene_read_body_name(t, s, part);
    output->at = text_whole(t, "mode", 1, s->body[output->body].shape.n) - 1;
    break;
  case SCENE_AT_GAUGE:
    scene_read_gauge_name(t, s, output);
    break;
  default:
    break;
  }
  if (scene_quantities[output->quantity].axes[0]) {
    output->axis = text_choice(t, "the axis", scene_quantities[output->quantity].axes);
  }
  s->n_output++;
}

static int scene_output_of(text_file *t, const scene *s)
{
  const char *const word = text_word(t);
  for (int k = 0; k < s->n_output && word; k++) {
    if (strcmp(s->output[k].label, word) == 0) {
      return k;
    }
  }
  text_fail(t, "no output has the name %s", word ? word : "(missing)");
  return 0;
}

/* The next word must be this one. */
static void scene_expect(text_file *t, const char *what)
{
  const char *const word = text_word(t);
  if (!word || strcmp(word, what) != 0) {
    text_fail(t, "expected %s, is %s", what, word ? word : "missing");
  }
}

/* measure LABEL max|min|mean|rms|final OUTPUT [after T] */
static void scene_read_measure(text_file *t, scene *s)
{
  scene_measure *const measure = &s->measure[s->n_measure];
  if (s->n_measure == SCENE_MEASURES) {
    text_fail(t, "more than %d measures", SCENE_MEASURES);
    return;
  }
  text_name(t, "a measure", measure->label);
  measure->kind = (scene_kind)text_choice(t, "a measure", scene_kinds);
  measure->output = scene_output_of(t, s);
  if (text_more(t)) {
    scene_expect(t, "after");
    measure->after = text_number(t, "time");
  }
  s->n_measure++;
}

/* ---- the file */

static const char *const scene_schemes[] = {"rk4", "midpoint", "sdirk", "exponential", NULL};

static void scene_read_step(text_file *t, scene *s)
{
  if (strncmp(t->at + strspn(t->at, " "), "auto", 4) == 0) {
    (void)text_word(t);
    return;
  }
  s->step = text_number(t, "step");
  if (!t->failed && !(s->step > 0)) {
    text_fail(t, "step must be greater than 0");
  }
}

static double scene_read_positive(text_file *t, const char *what)
{
  const double x = text_number(t, what);
  if (!t->failed && !(x > 0)) {
    text_fail(t, "%s must be greater than 0", what);
  }
  return x;
}

static void scene_read_gravity(text_file *t, scene *s)
{
  if (s->n_body > 0) {
    text_fail(t, "gravity must stand before the bodies");
  }
  text_vector(t, "gravity", s->gravity, 3);
}

/* Refuses a word that was there before. */
static void scene_once(text_file *t, scene *s, const char *word)
{
  for (int k = 0; k < s->n_seen; k++) {
    if (strcmp(word, s->seen[k]) == 0) {
      text_fail(t, "%s is there twice", word);
      return;
    }
  }
  strcpy(s->seen[s->n_seen++], word);
}

/* Words that stand once; 0 if it is none of them. */
static int scene_read_setting(text_file *t, scene *s, const char *word)
{
  static const char *const words[] = {"duration", "interval", "step", "scheme", "gravity", "trim", NULL};
  int k = 0;
  while (words[k] && strcmp(words[k], word) != 0) {
    k++;
  }
  if (!words[k]) {
    return 0;
  }
  scene_once(t, s, word);
  switch (k) {
  case 0:
    s->duration = scene_read_positive(t, word);
    break;
  case 1:
    s->interval = scene_read_positive(t, word);
    break;
  case 2:
    scene_read_step(t, s);
    break;
  case 3:
    s->scheme = (fb_scheme)text_choice(t, word, scene_schemes);
    break;
  case 4:
    scene_read_gravity(t, s);
    break;
  default:
    s->trim = 1;
    break;
  }
  return 1;
}

static void scene_read_line(text_file *t, scene *s, const char *word)
{
  static const struct {
    const char *word;
    void (*read)(text_file *t, scene *s);
  } lines[] = {{"parameter", scene_read_parameter}, {"body", scene_read_body},     {"load", scene_read_load},
               {"motion", scene_read_motion},       {"output", scene_read_output}, {"measure", scene_read_measure}};
  if (!scene_read_setting(t, s, word)) {
    int k = 0, n = (int)(sizeof lines / sizeof lines[0]);
    while (k < n && strcmp(lines[k].word, word) != 0) {
      k++;
    }
    if (k == n) {
      text_fail(t, "no such word: %s", word);
      return;
    }
    lines[k].read(t, s);
  }
  text_end_of_line(t);
}

/* What only the whole file tells. */
static void scene_check(text_file *t, scene *s)
{
  t->line = 0;
  if (s->n_body == 0) {
    text_fail(t, "a scene wants a body");
  }
  if (!(s->duration > 0)) {
    text_fail(t, "a scene wants a duration");
  }
  for (int k = 0; k < s->n_set; k++) {
    int there = 0;
    for (int i = 0; i < s->n_parameter; i++) {
      there |= strcmp(s->set[k].name, s->parameter[i].name) == 0;
    }
    if (!there) {
      text_fail(t, "no parameter has the name %s, which is to be set", s->set[k].name);
    }
  }
  s->interval = s->interval > 0 ? s->interval : s->duration / 1000;
}

/* 0, or 1 and the reason in s->message. */
static int scene_read(scene *s, const char *path, const scene_setting *set, int n_set)
{
  text_file t;
  memset(s, 0, sizeof *s);
  snprintf(s->path, sizeof s->path, "%s", path);
  s->set = set;
  s->n_set = n_set;
  if (!text_open(&t, "scene", path)) {
    return scene_fail(s, "%s", strerror(errno));
  }
  t.message = s->message;
  while (text_line(&t)) {
    scene_read_line(&t, s, text_word(&t));
  }
  scene_check(&t, s);
  text_close(&t);
  s->set = NULL;
  return t.failed;
}
#endif
