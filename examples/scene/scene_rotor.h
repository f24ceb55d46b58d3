/* scene_rotor.h - reads rotors of the bodies of a scene: wheels without a body and a joint of their own. See scene.h. */
#ifndef SCENE_ROTOR_H
#define SCENE_ROTOR_H
#include "scene_joint.h"

/* Of a rotor what its body has. */
static fb_rotor *scene_rotor_desc(scene *s, const scene_rotor *rotor)
{
  return &s->body[rotor->body].level.rotor[rotor->at];
}

static int scene_rotor_of(text_file *t, const scene *s)
{
  const char *const word = text_word(t);
  for (int k = 0; k < s->n_rotor && word; k++) {
    if (strcmp(s->rotor[k].name, word) == 0) {
      return k;
    }
  }
  text_fail(t, "no rotor has the name %s", word ? word : "(missing)");
  return 0;
}

/* A number that is not negative; above: nor zero. */
static fb_real scene_rotor_number(text_file *t, const char *what, int above)
{
  const double x = text_number(t, what);
  if (!t->failed && (x < 0 || (above && !(x > 0)))) {
    text_fail(t, above ? "%s must be greater than 0" : "%s must not be negative", what);
  }
  return (fb_real)x;
}

static void scene_read_rotor_line(text_file *t, scene *s, scene_rotor *rotor, const char *word)
{
  fb_rotor *const d = scene_rotor_desc(s, rotor);
  text_once(t, &rotor->seen, word);
  if (strcmp(word, "axis") == 0) {
    text_reals(t, word, d->axis, 3);
  } else if (strcmp(word, "inertia") == 0) {
    d->inertia = scene_rotor_number(t, word, 1);
  } else if (strcmp(word, "speed") == 0) {
    rotor->speed = text_number(t, word);
  } else if (strcmp(word, "momentum") == 0 || strcmp(word, "motor") == 0) {
    d->given |= word[2] == 'm';
    rotor->f = function_read(t, &s->tables, s->path);
  } else if (strcmp(word, "damping") == 0) {
    d->damping = scene_rotor_number(t, word, 0);
  } else if (strcmp(word, "friction") == 0) {
    d->friction = scene_rotor_number(t, word, 0);
    d->friction_speed = scene_rotor_number(t, "speed of friction", 1);
  } else if (strcmp(word, "static_imbalance") == 0) {
    d->static_imbalance = scene_rotor_number(t, word, 0);
  } else if (strcmp(word, "dynamic_imbalance") == 0) {
    d->dynamic_imbalance = scene_rotor_number(t, word, 0);
    d->dynamic_phase = text_more(t) ? (fb_real)text_degrees(t, "its phase") : FB_R(0.0);
  } else {
    text_fail(t, "no such word for a rotor: %s", word);
  }
  text_end_of_line(t);
}

/* What is missing, and what has no use. */
static void scene_check_rotor(text_file *t, scene *s, const scene_rotor *rotor)
{
  static const char *const own[] = {"speed", "motor", "damping", "friction"};
  const fb_rotor *const d = scene_rotor_desc(s, rotor);
  if (!(fabs((double)d->axis[0]) + fabs((double)d->axis[1]) + fabs((double)d->axis[2]) > 0)) {
    text_fail(t, "rotor %s wants an axis, not zero", rotor->name);
  }
  if (!(d->inertia > 0)) {
    text_fail(t, "rotor %s wants an inertia", rotor->name);
  }
  for (int k = 0; k < 4 && d->given && !t->failed; k++) {
    const int line = text_seen(&rotor->seen, own[k]);
    t->line = line > 0 ? line : t->line;
    if (line > 0) {
      text_fail(t, "%s of a rotor whose momentum is given", own[k]);
    }
  }
  if (d->given && (rotor->f.kind == FUNCTION_STEP || rotor->f.kind == FUNCTION_PULSE)) {
    t->line = text_seen(&rotor->seen, "momentum");
    text_fail(t, "a momentum must not jump: take ramp or smooth");
  }
}

/* rotor NAME NODE, its lines, end */
static void scene_read_rotor(text_file *t, scene *s)
{
  scene_rotor *const rotor = &s->rotor[s->n_rotor];
  const int begin = t->line;
  int ended = 0, node, last;
  if (s->n_rotor == SCENE_ROTORS) {
    text_fail(t, "more than %d rotors", SCENE_ROTORS);
    return;
  }
  memset(rotor, 0, sizeof *rotor);
  rotor->line = begin;
  rotor->control = -1;
  text_name(t, "a rotor", rotor->name);
  for (int k = 0; k < s->n_rotor; k++) {
    if (strcmp(s->rotor[k].name, rotor->name) == 0) {
      text_fail(t, "two rotors have the name %s", rotor->name);
    }
  }
  scene_read_node(t, s, &rotor->body, &node);
  text_end_of_line(t);
  if (t->failed) {
    return;
  }
  rotor->at = s->body[rotor->body].level.n_rotor;
  if (rotor->at == FB_MAX_ROTORS) {
    text_fail(t, "more than %d rotors of body %s", FB_MAX_ROTORS, s->body[rotor->body].name);
    return;
  }
  memset(scene_rotor_desc(s, rotor), 0, sizeof(fb_rotor));
  scene_rotor_desc(s, rotor)->node = node;
  while (!ended && text_line(t)) {
    const char *const word = text_word(t);
    ended = strcmp(word, "end") == 0;
    if (!ended) {
      scene_read_rotor_line(t, s, rotor, word);
    }
  }
  if (!ended) {
    text_fail(t, "rotor %s of line %d wants a line `end`", rotor->name, begin);
  }
  last = t->line;
  t->line = begin;
  scene_check_rotor(t, s, rotor);
  t->line = last;
  s->n_rotor += !t->failed;
  s->body[rotor->body].level.n_rotor += !t->failed;
}
#endif
