/* scene_body.h - reads names and bodies of a scene. See scene.h. */
#ifndef SCENE_BODY_H
#define SCENE_BODY_H
#include "scene_parts.h"

/* ---- names */

/* parameter NAME VALUE [what it is] */
static void scene_read_parameter(text_file *t, scene *s)
{
  text_named *const p = &s->parameter[s->n_parameter];
  char *const words = s->parameter_words[s->n_parameter];
  if (s->n_parameter == SCENE_PARAMETERS) {
    text_fail(t, "more than %d parameters", SCENE_PARAMETERS);
    return;
  }
  p->line = t->line;
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
    const size_t n = strlen(words);
    snprintf(words + n, sizeof s->parameter_words[0] - n, "%s%s", n ? " " : "", text_word(t));
  }
  t->named = s->parameter;
  t->n_named = ++s->n_parameter;
}

/* Node by name or number, -1: none. */
static int scene_find_node(const scene_body *body, const char *name)
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
  return strcmp(name, "origin") == 0 ? 0 : -1;
}

/* Node, or -1 after a complaint. */
static int scene_node_of(text_file *t, const scene_body *body, const char *name)
{
  const int node = scene_find_node(body, name);
  if (node < 0) {
    text_fail(t, "body %s has no node %s", body->name, name);
  }
  return node;
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

/* BODY, and nothing behind it. */
static int scene_read_whole_body(text_file *t, const scene *s)
{
  char part[TEXT_NAME];
  const int body = scene_read_body_name(t, s, part);
  if (part[0]) {
    text_fail(t, "a body is wanted, not %s of it", part);
  }
  return body;
}

/* BODY.NODE, or BODY for its origin. */
static void scene_read_node(text_file *t, const scene *s, int *body, int *node)
{
  char part[TEXT_NAME];
  *body = scene_read_body_name(t, s, part);
  *node = t->failed || !part[0] ? 0 : scene_node_of(t, &s->body[*body], part);
}

/* ---- bodies */

/* gauge NAME X Y Z, in a body of parts gauge NAME BEAM X Y Z: kept until the body's modes are known */
typedef struct scene_gauge_line {
  int n, part[SCENE_GAUGES];
  double x[SCENE_GAUGES][3];
} scene_gauge_line;

/* Which part of the body that is read a beam is. */
static int scene_read_beam(text_file *t, const scene_body *body)
{
  const char *const name = model.kind == MODEL_PARTS ? text_word(t) : "";
  for (int k = 0; k < model.n_part && name; k++) {
    if (model.part[k].kind == MODEL_BEAM && strcmp(model.part[k].name, name) == 0) {
      return k;
    }
  }
  text_fail(t, model.kind == MODEL_PARTS ? "no beam of body %s has the name %s" : "gauges are on beams", body->name,
            name ? name : "(missing)");
  return 0;
}

static void scene_read_gauge(text_file *t, scene_body *body, scene_gauge_line *gauges)
{
  if (gauges->n == SCENE_GAUGES) {
    text_fail(t, "more than %d gauges", SCENE_GAUGES);
    return;
  }
  text_name(t, "a gauge", body->gauge_name[gauges->n]);
  for (int k = 0; k < gauges->n; k++) {
    if (strcmp(body->gauge_name[k], body->gauge_name[gauges->n]) == 0) {
      text_fail(t, "two gauges have the name %s", body->gauge_name[k]);
    }
  }
  gauges->part[gauges->n] = scene_read_beam(t, body);
  text_vector(t, "place along the beam, y and z off its line", gauges->x[gauges->n++], 3);
}

/* Refuses a word that was there before with that number. */
static void scene_once_numbered(text_file *t, text_words *words, const char *word, int number)
{
  char all[TEXT_NAME];
  snprintf(all, sizeof all, "%.16s %d", word, number);
  text_once(t, words, all);
}

/* Line of a word with that number, 0 if it was not there. */
static int scene_seen_numbered(const text_words *words, const char *word, int number)
{
  char all[TEXT_NAME];
  snprintf(all, sizeof all, "%.16s %d", word, number);
  return text_seen(words, all);
}

/* form momentum, second or first [identity, printed or boundary]: of the stiffness torque */
static void scene_read_form(text_file *t, fb_form_desc *form)
{
  static const char *const forms[] = {"momentum", "second", "first", NULL};
  static const char *const torques[] = {"identity", "printed", "boundary", NULL};
  form->form = (fb_form)text_choice(t, "form", forms);
  if (form->form == FB_FORM_FIRST && text_more(t)) {
    form->stiffness_torque = (fb_stiffness_torque)text_choice(t, "stiffness torque", torques);
  }
}

/* truncate Q: terms of a higher degree are left out; 3: none */
static void scene_read_truncation(text_file *t)
{
  const int degree = text_whole(t, "highest degree", 0, 3);
  model.level.truncation = degree < 3 ? (fb_truncation)(FB_TRUNCATE_ABOVE_0 + degree) : FB_TRUNCATE_NONE;
  model.level.allow_split_effects = degree < 3;
}

/* Words of a body that are the scene's; 0 if it is none of them. */
static int scene_read_start(text_file *t, scene_body *body, const char *word)
{
  static const char *const once[] = {"start_position", "start_attitude", "start_velocity", "start_spin",
                                     "auto",           "form",           "truncate"};
  for (int k = 0; k < (int)(sizeof once / sizeof *once); k++) {
    if (strcmp(word, once[k]) == 0) {
      text_once(t, &body->seen, word);
    }
  }
  if (strcmp(word, "start_position") == 0) {
    text_vector(t, word, body->position, 3);
  } else if (strcmp(word, "start_attitude") == 0) {
    model_attitude(t, body->attitude);
  } else if (strcmp(word, "start_velocity") == 0) {
    text_vector(t, word, body->velocity, 3);
  } else if (strcmp(word, "start_spin") == 0) {
    text_vector(t, word, body->spin, 3);
  } else if (strcmp(word, "start_mode") == 0) {
    const int k = text_whole(t, "mode", 1, FB_MAX_MODES) - 1;
    scene_once_numbered(t, &body->seen, word, k + 1);
    body->q[k] = text_number(t, "its coordinate");
    body->q_dot[k] = text_more(t) ? text_number(t, "its rate") : 0;
  } else if (strcmp(word, "auto") == 0) {
    body->tolerance = text_number(t, "tolerance");
    if (!t->failed && !(body->tolerance > 0)) {
      text_fail(t, "a tolerance must be greater than 0");
    }
  } else if (strcmp(word, "form") == 0) {
    scene_read_form(t, &body->form);
  } else if (strcmp(word, "truncate") == 0) {
    scene_read_truncation(t);
  } else {
    return 0;
  }
  text_end_of_line(t);
  return 1;
}

/* The stiffness torque of the beams as printed. */
static fb_status scene_add_torque(scene_body *body)
{
  fb_status status = FB_OK;
  for (int p = 0; p < model.n_part && body->form.stiffness_torque != FB_TORQUE_IDENTITY && status == FB_OK; p++) {
    status = model.part[p].kind != MODEL_BEAM
                 ? FB_OK
                 : fb_form_torque_add_beam(&body->torque, &model_shape, model.part[p].first, &model_beam[p],
                                           &model_modes[p]);
  }
  return status;
}

/* [rad/s], [m] Of bodies with modes of rest: their modes are to be shaped for that spin, so far from its axis; 0: as they are. */
static double scene_spun[FB_MAX_BODIES][2];

static int scene_draws = 1; /* 0: a program that draws nothing */

/* Nodes along the beams, to draw them by. */
static fb_status scene_add_drawn(scene_body *body)
{
  fb_status status = FB_OK;
  int n;
  for (int k = 0; k < model.n_part; k++) {
    body->n_beam += model.part[k].kind == MODEL_BEAM;
  }
  for (int k = 1; k < body->n_node; k++) {
    const int part = model.node_part[k];
    body->on_beam[k] = part >= 0 && model.part[part].kind == MODEL_BEAM;
  }
  n = (body->n_node <= 12 ? 24 : FB_MAX_NODES) - body->n_node;
  n = scene_draws && body->n_beam > 0 ? n / body->n_beam - 1 : 0;
  body->n_drawn = n > 0 ? n + 1 : 0;
  for (int p = 0; p < model.n_part; p++) {
    const fb_beam *const beam = &model_beam[p];
    for (int k = 0; k < body->n_drawn && model.part[p].kind == MODEL_BEAM && status == FB_OK; k++) {
      int at;
      status = fb_shape_add_beam_node(&model_shape, &at, model.part[p].first, beam, &model_modes[p],
                                      beam->start[beam->desc.n_element] * (fb_real)k / (fb_real)n);
    }
  }
  return status;
}
#endif
