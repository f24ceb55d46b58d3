/* rotor_text.h - the words of a rotor (fb_rotor), of descriptions of bodies and of scenes alike. scenes/README.md lists
   them. Include flexbeam.h and text.h first. */
#ifndef ROTOR_TEXT_H
#define ROTOR_TEXT_H

typedef struct rotor_text { /* what an fb_rotor has not */
  char name[2 * TEXT_NAME]; /* in a scene, of a body's description: BODY.NAME */
  int line;                 /* where it begins */
  text_words seen;          /* in its lines */
  double speed;             /* [rad/s] at the start */
} rotor_text;

/* A number that is not negative; above: nor zero. */
static inline fb_real rotor_number(text_file *t, const char *what, int above)
{
  const double x = text_number(t, what);
  if (!t->failed && (x < 0 || (above && !(x > 0)))) {
    text_fail(t, above ? "%s must be greater than 0" : "%s must not be negative", what);
  }
  return (fb_real)x;
}

/* like OTHER X Y Z, once OTHER is found: the same wheel about another axis. */
static inline void rotor_like(text_file *t, rotor_text *rotor, fb_rotor *d, const rotor_text *other,
                              const fb_rotor *its)
{
  *d = *its;
  rotor->seen = other->seen;
  rotor->speed = other->speed;
  text_reals(t, "axis", d->axis, 3);
  if (!t->failed && !(fabs((double)d->axis[0]) + fabs((double)d->axis[1]) + fabs((double)d->axis[2]) > 0)) {
    text_fail(t, "rotor %s wants an axis, not zero", rotor->name);
  }
}

/* A line that begins with that word; 0: the word is none of a rotor, or motor or momentum, which whoever drives it
   reads. */
static inline int rotor_line(text_file *t, rotor_text *rotor, fb_rotor *d, const char *word)
{
  text_once(t, &rotor->seen, word);
  if (strcmp(word, "axis") == 0) {
    text_reals(t, word, d->axis, 3);
  } else if (strcmp(word, "inertia") == 0) {
    d->inertia = rotor_number(t, word, 1);
  } else if (strcmp(word, "speed") == 0) {
    rotor->speed = text_number(t, word);
  } else if (strcmp(word, "damping") == 0) {
    d->damping = rotor_number(t, word, 0);
  } else if (strcmp(word, "friction") == 0) {
    d->friction = rotor_number(t, word, 0);
    d->friction_speed = rotor_number(t, "speed of friction", 1);
  } else if (strcmp(word, "static_imbalance") == 0) {
    d->static_imbalance = rotor_number(t, word, 0);
  } else if (strcmp(word, "dynamic_imbalance") == 0) {
    d->dynamic_imbalance = rotor_number(t, word, 0);
    d->dynamic_phase = text_more(t) ? (fb_real)text_degrees(t, "its phase") : FB_R(0.0);
  } else {
    return 0;
  }
  return 1;
}

/* What is missing, and what has no use. */
static inline void rotor_check(text_file *t, const rotor_text *rotor, const fb_rotor *d)
{
  static const char *const own[] = {"speed", "motor", "damping", "friction"};
  const double value[] = {rotor->speed, 0, (double)d->damping, (double)d->friction};
  if (!(fabs((double)d->axis[0]) + fabs((double)d->axis[1]) + fabs((double)d->axis[2]) > 0)) {
    text_fail(t, "rotor %s wants an axis, not zero", rotor->name);
  }
  if (!(d->inertia > 0)) {
    text_fail(t, "rotor %s wants an inertia", rotor->name);
  }
  for (int k = 0; k < 4 && d->given && !t->failed; k++) {
    const int line = text_seen(&rotor->seen, own[k]);
    t->line = line > 0 ? line : t->line;
    if (line > 0 || fabs(value[k]) > 0) {
      text_fail(t, "%s of a rotor whose momentum is given", own[k]);
    }
  }
}

/* Lines up to `end`; other: reads what follows a word that rotor_line does not know, 0: nor does it. */
static inline void rotor_block(text_file *t, rotor_text *rotor, fb_rotor *d,
                               int (*other)(text_file *t, void *user, const char *word), void *user)
{
  const int begin = t->line;
  int last;
  text_begin(t, "rotor", rotor->name);
  while (text_within(t)) {
    const char *const word = text_word(t);
    if (!rotor_line(t, rotor, d, word) && !other(t, user, word)) {
      text_fail(t, "no such word for a rotor: %s", word);
    }
    text_end_of_line(t);
  }
  last = t->line;
  t->line = begin; /* what is missing has no line of its own */
  rotor_check(t, rotor, d);
  t->line = last;
}
#endif
