/* scene.h - a scene from a text file: bodies, joints, loads, what is to be written and measured. scenes/README.md
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
#include "scene_control.h"

/* ---- bodies */

/* The complaint that follows is about the line of what could not be built. */
static void scene_at_part(text_file *t, const char *what)
{
  static const char *const parts[][2] = {
      {"the beam", "stations"}, {"its modes", "modes"}, {"its integrals", "modes"}, {"no mode is left", "modes"},
      {"damping", "damping"},   {"the hub", "hub"},     {"a node", "node"}};
  for (int k = 0; k < (int)(sizeof parts / sizeof *parts); k++) {
    if (strstr(what, parts[k][0])) {
      model_at(t, model.built < 0 ? NULL : &model.part[model.built], parts[k][1]);
    }
  }
}

/* How each mode of a beam that is the whole body turns its root, axes of the body. */
static void scene_root_turns(scene_body *body)
{
  const fb_modes *const modes = &model_modes[0];
  const fb_real *const R = model_beam[0].axes;
  for (int a = 0; a < modes->n; a++) {
    for (int i = 0; i < 9; i++) {
      body->turn[a][i / 3] += R[i] * modes->shape[a * modes->ndof + 3 + i % 3];
    }
  }
}

/* The shape of the description that was read. */
static void scene_build_body(text_file *t, scene *s, scene_body *body, const scene_gauge_line *gauges)
{
  const double *const spun = scene_spun[s->n_body];
  const char *what;
  fb_status status;
  body->rests = model_rests();
  if (spun[0] > 0) {
    model_spin_modes(spun[0], spun[1]);
  }
  status = model_build_shape(&what);
  body->kind = model.kind;
  body->level = model.level;
  body->root = model_loose_root();
  if (status == FB_OK && body->root == FB_ROOT_PINNED) {
    scene_root_turns(body);
  }
  memcpy(body->warning, model.warning, sizeof body->warning);
  if (!body->warning[0]) {
    (void)model_lacks_stiffening(body->warning, NULL);
  }
  body->n_node = model_shape.n_node;
  body->n_gauge = gauges->n;
  memcpy(body->node_name, model.node_name, sizeof body->node_name);
  if (status == FB_OK && body->n_node > SCENE_NODES + 1) {
    text_fail(t, "more than %d nodes", SCENE_NODES);
  }
  for (int k = 0; k < gauges->n && status == FB_OK; k++) {
    const int part = gauges->part[k];
    what = "a gauge";
    status = fb_gauge_init(&body->gauge[k], model.part[part].first, &model_beam[part], &model_modes[part],
                           (fb_real)gauges->x[k][0], (fb_real)gauges->x[k][1], (fb_real)gauges->x[k][2]);
  }
  if (status == FB_OK) {
    status = scene_add_torque(body);
  }
  if (status == FB_OK) {
    status = scene_add_drawn(body);
  }
  if (status != FB_OK) {
    scene_at_part(t, what);
    text_fail(t, "%s: %s", what, refusal_text(status));
  }
  copy_memory(&body->shape, &model_shape, sizeof model_shape);
  if (s->exact_elements > 0 && !t->failed) {
    s->is_exact = 1;
    scene_convert_exact(t, s, body);
  }
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
  text_beside(path, s->path, name);
  if (text_try(&other, t->program, path)) {
    other.message = t->message;
    other.fault = t->fault;
    other.named = t->named;
    other.n_named = t->n_named;
    model_lines(&other);
  } else {
    text_fail(t, "%s: %s", path, strerror(errno));
  }
  t->failed |= other.failed;
  text_close(&other);
}

static void scene_read_model_line(text_file *t, scene *s, scene_body *body, const char *word)
{
  (void)s;
  (void)body;
  model_line(t, word);
}

static void scene_begin_exact(text_file *t, scene *s, scene_body *body)
{
  if (s->n_body > 0) {
    text_fail(t, "an exact beam stands alone");
  }
  s->is_exact = 1;
  model_begin(MODEL_BEAM); /* of which nothing is used */
  body->kind = MODEL_BEAM;
  body->n_node = 1;
  exact_begin(&s->exact);
}

static void scene_name_body(text_file *t, const scene *s, scene_body *body)
{
  text_name(t, "a body", body->name);
  for (int k = 0; k < s->n_body; k++) {
    if (strcmp(s->body[k].name, body->name) == 0) {
      text_fail(t, "two bodies have the name %s", body->name);
    }
  }
  if (strcmp(body->name, "ground") == 0) {
    text_fail(t, "ground is what is at rest: no name of a body");
  }
}

/* like OTHER: the same body, with rotors of its own. */
static void scene_body_like(text_file *t, scene *s, scene_body *body)
{
  const int other = scene_read_whole_body(t, s), n = s->n_rotor;
  char name[TEXT_NAME];
  if (!t->failed && s->is_exact) {
    text_fail(t, "an exact beam stands alone");
  }
  if (t->failed) {
    return;
  }
  strcpy(name, body->name);
  copy_memory(body, &s->body[other], sizeof *body);
  strcpy(body->name, name);
  body->line = t->line;
  for (int k = 0; k < n && !t->failed; k++) {
    if (s->rotor[k].body == other) {
      scene_rotor_copy(t, s, &s->rotor[k], s->n_body);
    }
  }
  s->n_body += !t->failed;
}

/* body NAME beam|component|rigid|parts, its lines, end; body NAME file FILE, further lines, end; or body NAME like OTHER
*/
static void scene_read_body(text_file *t, scene *s)
{
  static const char *const kinds[] = {"beam", "component", "rigid", "parts", "file", "exact", NULL};
  enum { OTHER_FILE = MODEL_PARTS + 1, EXACT };
  scene_body *const body = &s->body[s->n_body];
  scene_gauge_line gauges = {0};
  const int begin = t->line;
  int kind, last;
  if (s->n_body == FB_MAX_BODIES) {
    text_fail(t, "more than %d bodies", FB_MAX_BODIES);
    return;
  }
  clear_memory(body, sizeof *body);
  body->attitude[0] = 1;
  body->line = begin;
  scene_name_body(t, s, body);
  if (text_take(t, "like")) {
    scene_body_like(t, s, body);
    return;
  }
  kind = text_choice(t, "a body", kinds);
  if (kind == EXACT) {
    scene_begin_exact(t, s, body);
  } else if (kind < OTHER_FILE) {
    model_begin((model_kind)kind);
  } else {
    scene_read_model(t, s);
    model_forget_lines(); /* lines here may change what it says */
  }
  text_end_of_line(t);
  text_begin(t, "body", body->name);
  while (text_within(t)) {
    const char *const word = text_word(t);
    if (strcmp(word, "gauge") == 0) {
      text_note(t, &body->seen, word);
      scene_read_gauge(t, body, &gauges);
    } else if (!scene_read_start(t, body, word)) {
      (kind == EXACT ? scene_read_exact_line : scene_read_model_line)(t, s, body, word);
    }
  }
  last = t->line;
  t->line = begin; /* what is missing has no line of its own */
  if (kind == EXACT) {
    scene_check_exact_body(t, s, body);
    scene_place_exact(t, s, body);
  } else {
    body->base_line = text_seen(&model.seen, "base");
    scene_pull_body(t, s);
    model.level.effects |= body->tolerance > 0 && model_is_damped() ? (unsigned)FB_EFFECT_DAMPING : 0u;
    model_check(t);
    if (!t->failed) {
      scene_build_body(t, s, body, &gauges);
    }
    scene_check_modes(t, s, body);
    scene_check_form(t, body);
    scene_check_auto(t, body);
    scene_take_rotors(t, s, s->n_body);
  }
  memcpy(body->doubt, kind == EXACT ? s->exact.doubt : model.doubt,
         kind == EXACT ? sizeof s->exact.doubt : sizeof model.doubt);
  scene_check_nodes(t, body);
  s->n_body += !t->failed;
  t->line = last;
}

/* ---- loads and the motion of the base */

/* What follows a vector: a function, or nothing, for a constant. */
static function scene_read_function(text_file *t, scene *s)
{
  return text_more(t) ? function_read(t, &s->tables, s->path) : function_of_one;
}

/* load BODY.NODE dead|follower|base force|torque X Y Z [FUNCTION]; nudge: the same without a function */
static void scene_read_any_load(text_file *t, scene *s, int nudge)
{
  static const char *const axes[] = {"dead", "follower", "base", NULL};
  scene_load *const load = &s->load[s->n_load];
  if (s->n_load == SCENE_LOADS) {
    text_fail(t, "more than %d loads", SCENE_LOADS);
    return;
  }
  load->nudge = nudge;
  load->act = -1;
  scene_read_node(t, s, &load->body, &load->node);
  load->axes = (fb_axes)text_choice(t, "axes of a load", axes);
  load->torque = scene_read_force_or_torque(t, load->vector);
  load->f = nudge ? function_of_one : scene_read_function(t, s);
  s->n_load++;
}

static void scene_read_load(text_file *t, scene *s)
{
  scene_read_any_load(t, s, 0);
}

static void scene_read_nudge(text_file *t, scene *s)
{
  scene_read_any_load(t, s, 1);
}

/* distributed BODY dead|follower force|torque X Y Z [to X Y Z] [FUNCTION]: per length, linear from root to tip */
static void scene_read_distributed(text_file *t, scene *s)
{
  static const char *const axes[] = {"dead", "follower", NULL};
  scene_distributed *const d = &s->distributed[s->n_distributed];
  if (s->n_distributed == SCENE_DISTRIBUTED) {
    text_fail(t, "more than %d distributed loads", SCENE_DISTRIBUTED);
    return;
  }
  d->line = t->line;
  d->body = scene_read_whole_body(t, s);
  d->follower = text_choice(t, "axes of a distributed load", axes);
  d->torque = scene_read_force_or_torque(t, d->vector);
  memcpy(d->end, d->vector, sizeof d->end);
  if (text_take(t, "to")) {
    text_vector(t, "at the tip", d->end, 3);
  }
  d->f = scene_read_function(t, s);
  if (!t->failed && (s->is_exact || !(s->body[d->body].level.effects & FB_EFFECT_LARGE_DEFLECTION))) {
    text_fail(t, "distributed loads are on beams with `effects large`; an exact beam has `line` among its own words");
  }
  s->n_distributed++;
}

/* What holds an exact beam at the node that follows is moved along x y z. */
static void scene_read_support(text_file *t, const scene *s, scene_motion *motion)
{
  double x[6] = {0};
  int body;
  scene_read_node(t, s, &body, &motion->node);
  text_vector(t, motion->rate ? "rotation" : "displacement", motion->vector, 3);
  memcpy(x + 3 * motion->rate, motion->vector, sizeof motion->vector);
  if (!s->is_exact) {
    text_fail(t, "displacement and rotation are of supports of an exact beam; a base moves by velocity and rate");
  } else if (!t->failed) {
    exact_check_move(t, &s->exact, s->body[body].element_node[motion->node], x);
  }
}

/* motion velocity|rate X Y Z [FUNCTION], motion displacement|rotation BODY.NODE X Y Z [FUNCTION] */
static void scene_read_motion(text_file *t, scene *s)
{
  static const char *const kinds[] = {"velocity", "rate", "displacement", "rotation", NULL};
  int kind;
  scene_motion *const motion = &s->motion[s->n_motion];
  if (s->n_motion == SCENE_MOTIONS) {
    text_fail(t, "more than %d lines of motion", SCENE_MOTIONS);
    return;
  }
  kind = text_choice(t, "motion of the base, or of a support", kinds);
  motion->rate = kind % 2;
  motion->support = kind > 1;
  if (motion->support) {
    scene_read_support(t, s, motion);
  } else {
    text_vector(t, kinds[kind], motion->vector, 3);
  }
  motion->f = scene_read_function(t, s);
  s->n_motion++;
}

/* ---- the file */

static const char *const scene_integrators[] = {"rk4", "midpoint", "sdirk", "exponential", "auto", NULL};
typedef char scene_integrators_are_whole[sizeof scene_integrators / sizeof(char *) == FB_INTEGRATOR_COUNT + 2 ? 1 : -1];

static void scene_read_step(text_file *t, scene *s)
{
  if (text_take(t, "auto")) {
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

/* view top|front|side|aslant|any [BODY] */
static void scene_read_view(text_file *t, scene *s)
{
  static const char *const views[] = {"any", "top", "front", "side", "aslant", NULL};
  s->view = (scene_view_from)text_choice(t, "a view", views);
  s->view_of = text_more(t) ? scene_read_whole_body(t, s) : -1;
}

/* The rest of the line. */
static void scene_read_title(text_file *t, scene *s)
{
  const char *word;
  size_t n = 0;
  while ((word = text_word(t)) != NULL && n < sizeof s->title) {
    n += (size_t)snprintf(s->title + n, sizeof s->title - n, "%s%s", n ? " " : "", word);
  }
  if (n >= sizeof s->title) {
    text_fail(t, "a title has %d characters at most", (int)sizeof s->title - 1);
  }
  if (s->title[strcspn(s->title, "<>&")]) {
    text_fail(t, "a title has none of < > &");
  }
}

static void scene_read_duration(text_file *t, scene *s)
{
  s->duration = scene_read_positive(t, "duration");
}

static void scene_read_interval(text_file *t, scene *s)
{
  s->interval = scene_read_positive(t, "interval");
}

static void scene_read_integrator(text_file *t, scene *s)
{
  const int k = text_choice(t, "integrator", scene_integrators);
  s->integrator_auto = strcmp(scene_integrators[k], "auto") == 0;
  s->integrator = s->integrator_auto ? FB_INTEGRATOR_RK4 : (fb_integrator)k;
}

static void scene_read_trim(text_file *t, scene *s)
{
  (void)t;
  s->trim = 1;
}

static void scene_read_method(text_file *t, scene *s)
{
  static const char *const methods[] = {"recursive", "dense", NULL};
  s->method = (fb_method)text_choice(t, "method (joints as constraints: loop, on free bodies)", methods);
}

static void scene_read_exact(text_file *t, scene *s)
{
  if (s->n_body > 0) {
    text_fail(t, "exact must stand before the body");
  }
  s->exact_elements = text_whole(t, "elements of the exact beam", 0, FB_MAX_EXACT);
}

/* No line of a scene begins with that word: perhaps one of a block does. */
static void scene_no_word(text_file *t, const char *word)
{
  static const struct {
    const char *word, *block;
  } inside[] = {{"start_position", "body"}, {"start_attitude", "body"}, {"start_velocity", "body"},
                {"start_spin", "body"},     {"start_mode", "body"},     {"hub", "body"},
                {"length", "body"},         {"stations", "body"},       {"modes", "body"},
                {"effects", "body"},        {"base", "body"},           {"node", "body"},
                {"auto", "body"},           {"gauge", "body"},          {"start", "joint"},
                {"axis", "joint"},          {"stops", "joint"},         {"motor", "joint"},
                {"sample", "control"},      {"pid", "control"}};
  for (int k = 0; k < (int)(sizeof inside / sizeof *inside); k++) {
    if (strcmp(word, inside[k].word) == 0) {
      text_fail(t, "no such word: %s; it belongs between `%s` and its `end`", word, inside[k].block);
    }
  }
  text_fail(t, "no such word: %s", word);
}

static void scene_read_line(text_file *t, scene *s, const char *word)
{
  static const struct {
    const char *word;
    void (*read)(text_file *t, scene *s);
    int once;
  } lines[] = {{"title", scene_read_title, 1},
               {"duration", scene_read_duration, 1},
               {"interval", scene_read_interval, 1},
               {"step", scene_read_step, 1},
               {"integrator", scene_read_integrator, 1},
               {"method", scene_read_method, 1},
               {"gravity", scene_read_gravity, 1},
               {"trim", scene_read_trim, 1},
               {"exact", scene_read_exact, 1},
               {"view", scene_read_view, 1},
               {"units", scene_read_units, 1},
               {"parameter", scene_read_parameter, 0},
               {"body", scene_read_body, 0},
               {"joint", scene_read_joint, 0},
               {"loop", scene_read_loop, 0},
               {"spring", scene_read_spring, 0},
               {"rotor", scene_read_rotor, 0},
               {"event", scene_read_event, 0},
               {"load", scene_read_load, 0},
               {"nudge", scene_read_nudge, 0},
               {"distributed", scene_read_distributed, 0},
               {"motion", scene_read_motion, 0},
               {"allocation", scene_read_allocation, 0},
               {"control", scene_read_control, 0},
               {"output", scene_read_output, 0},
               {"measure", scene_read_measure, 0},
               {"expect", scene_read_expectation, 0},
               {"reference", scene_read_reference, 0}};
  int k = 0, n = (int)(sizeof lines / sizeof lines[0]);
  while (k < n && strcmp(lines[k].word, word) != 0) {
    k++;
  }
  if (k == n) {
    scene_no_word(t, word);
    return;
  }
  if (lines[k].once) {
    text_once(t, &s->seen, word);
  }
  text_note(t, &s->seen, word);
  lines[k].read(t, s);
  text_end_of_line(t);
}

/* Of a text in memory, which is called `path`; NULL: of that file. 0, or 1 and the reason in s->message. */
static int scene_read_of(scene *s, const char *path, const char *text, const scene_setting *set, int n_set)
{
  text_file t;
  clear_memory(s, offsetof(scene, body));
  snprintf(s->path, sizeof s->path, "%s", path);
  s->set = set;
  s->n_set = n_set;
  s->integrator_auto = 1;
  s->view_of = -1;
  strcpy(s->length_unit, "m");
  strcpy(s->force_unit, "N");
  if (!text_try_of(&t, "scene", path, text)) {
    return scene_fail(s, "%s", strerror(errno));
  }
  t.message = s->message;
  t.fault = &s->fault;
  while (text_line(&t)) {
    scene_read_line(&t, s, text_word(&t));
  }
  scene_check(&t, s);
  text_close(&t);
  s->set = NULL;
  return t.failed;
}

static inline int scene_read(scene *s, const char *path, const scene_setting *set, int n_set)
{
  return scene_read_of(s, path, NULL, set, n_set);
}
#endif
