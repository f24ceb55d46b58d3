/* scene_rotor.h - reads rotors of the bodies of a scene: wheels without a body and a joint of their own. See scene.h.
   */
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
    if (strcmp(s->rotor[k].text.name, word) == 0) {
      return k;
    }
  }
  text_fail(t, "no rotor has the name %s", word ? word : "(missing)");
  return 0;
}

typedef struct scene_rotor_lines { /* of which rotor they are */
  scene *s;
  scene_rotor *rotor;
} scene_rotor_lines;

/* motor FUNCTION, momentum FUNCTION */
static int scene_read_rotor_drive(text_file *t, void *user, const char *word)
{
  const scene_rotor_lines *const to = (const scene_rotor_lines *)user;
  const int given = strcmp(word, "momentum") == 0;
  if (!given && strcmp(word, "motor") != 0) {
    return 0;
  }
  scene_rotor_desc(to->s, to->rotor)->given |= given;
  to->rotor->f = function_read(t, &to->s->tables, to->s->path);
  if (!t->failed && given && (to->rotor->f.kind == FUNCTION_STEP || to->rotor->f.kind == FUNCTION_PULSE)) {
    text_fail(t, "a momentum must not jump: take ramp or smooth");
  }
  return 1;
}

/* One more rotor of a body, of which nothing else is known yet; NULL: there is no room. */
static scene_rotor *scene_begin_rotor(text_file *t, scene *s, int body, int line)
{
  scene_rotor *const rotor = &s->rotor[s->n_rotor];
  if (s->n_rotor == SCENE_ROTORS) {
    text_fail(t, "more than %d rotors", SCENE_ROTORS);
    return NULL;
  }
  memset(rotor, 0, sizeof *rotor);
  rotor->text.line = line;
  rotor->act = -1;
  rotor->body = body;
  return rotor;
}

/* The rotors of a body's description, BODY.NAME in the scene, whose lines may change them. */
static void scene_take_rotors(text_file *t, scene *s, int body)
{
  for (int k = 0; k < model.level.n_rotor && !t->failed; k++) {
    scene_rotor *const rotor = scene_begin_rotor(t, s, body, s->body[body].line);
    char name[2 * TEXT_NAME];
    if (rotor) {
      snprintf(name, sizeof name, "%.*s.%.*s", TEXT_NAME - 1, s->body[body].name, TEXT_NAME - 1,
               model.rotor[k].text.name);
      strcpy(rotor->text.name, name);
      rotor->text.speed = model.rotor[k].text.speed;
      rotor->f.a = model.rotor[k].momentum;
      rotor->at = k;
      s->n_rotor++;
    }
  }
}

/* A rotor of a body that is like another one: BODY.NAME, NAME that without the other body's. */
static void scene_rotor_copy(text_file *t, scene *s, const scene_rotor *other, int body)
{
  scene_rotor *const rotor = scene_begin_rotor(t, s, body, t->line);
  const char *const point = strchr(other->text.name, '.');
  char name[2 * TEXT_NAME];
  if (rotor) {
    snprintf(name, sizeof name, "%.*s.%.*s", TEXT_NAME - 1, s->body[body].name, TEXT_NAME - 1,
             point ? point + 1 : other->text.name);
    *rotor = *other;
    strcpy(rotor->text.name, name);
    rotor->text.line = t->line;
    rotor->act = -1;
    rotor->body = body;
    s->n_rotor++;
  }
}

/* like OTHER X Y Z, a rotor of the same body. */
static void scene_rotor_like(text_file *t, scene *s, scene_rotor *rotor)
{
  const scene_rotor *const other = &s->rotor[scene_rotor_of(t, s)];
  if (!t->failed) {
    rotor->body = other->body;
    rotor->f = other->f;
    rotor->at = s->body[rotor->body].level.n_rotor;
  }
  if (!t->failed && rotor->at < FB_MAX_ROTORS) {
    rotor_like(t, &rotor->text, scene_rotor_desc(s, rotor), &other->text, &s->body[other->body].level.rotor[other->at]);
  }
}

/* NAME NODE of one more rotor, or NAME like OTHER. */
static scene_rotor *scene_name_rotor(text_file *t, scene *s, int *like)
{
  scene_rotor *const rotor = scene_begin_rotor(t, s, 0, t->line);
  int node = 0;
  if (!rotor) {
    return NULL;
  }
  text_name(t, "a rotor", rotor->text.name);
  for (int k = 0; k < s->n_rotor; k++) {
    if (strcmp(s->rotor[k].text.name, rotor->text.name) == 0) {
      text_fail(t, "two rotors have the name %s", rotor->text.name);
    }
  }
  *like = text_take(t, "like");
  if (*like) {
    scene_rotor_like(t, s, rotor);
  } else {
    scene_read_node(t, s, &rotor->body, &node);
  }
  text_end_of_line(t);
  if (t->failed) {
    return NULL;
  }
  rotor->at = s->body[rotor->body].level.n_rotor;
  if (rotor->at == FB_MAX_ROTORS) {
    text_fail(t, "more than %d rotors of body %s", FB_MAX_ROTORS, s->body[rotor->body].name);
    return NULL;
  }
  if (!*like) {
    memset(scene_rotor_desc(s, rotor), 0, sizeof(fb_rotor));
    scene_rotor_desc(s, rotor)->node = node;
  }
  return rotor;
}

/* rotor NAME NODE, its lines, end; rotor NAME like OTHER X Y Z; or rotor BODY.NAME, further lines of that rotor of the
   body's description, end */
static void scene_read_rotor(text_file *t, scene *s)
{
  const char *const next = t->at + strspn(t->at, " ");
  const int old = memchr(next, '.', strcspn(next, " ")) != NULL, at = old ? scene_rotor_of(t, s) : s->n_rotor;
  int like = 0;
  scene_rotor_lines to = {s, old ? &s->rotor[at] : scene_name_rotor(t, s, &like)};
  text_end_of_line(t);
  if (t->failed) {
    return;
  }
  if (!like) {
    rotor_block(t, &to.rotor->text, scene_rotor_desc(s, to.rotor), scene_read_rotor_drive, &to);
  }
  if (!old && !t->failed) {
    s->n_rotor++;
    s->body[to.rotor->body].level.n_rotor++;
  }
}
#endif
