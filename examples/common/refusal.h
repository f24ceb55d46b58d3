/* refusal.h - what fb_detail_last tells, in one line after the text of the status. Include after flexbeam.h; without
   FB_WITH_DETAIL there is the text alone. */
#ifndef REFUSAL_H
#define REFUSAL_H
#include <stdio.h>
#include <string.h>

#if FB_WITH_DETAIL
/* 1 if a phrase ends with a relation, which the bound follows. */
static inline int refusal_has_bound(const char *what)
{
  static const char *const word[] = {" at least", " at most", " above", " below", " beyond", " equal to"};
  const size_t length = strlen(what);
  for (int k = 0; k < (int)(sizeof word / sizeof word[0]); k++) {
    const size_t n = strlen(word[k]);
    if (length > n && strcmp(what + length - n, word[k]) == 0) {
      return 1;
    }
  }
  return 0;
}
#endif

#define REFUSAL_LENGTH ((size_t)512)

/* " (fb_beam_init: station 2: EI_y [N m^2], at least 0: -3)", or nothing if the record is of something else. */
static inline void refusal_write(char text[REFUSAL_LENGTH], fb_status status)
{
  text[0] = '\0';
#if FB_WITH_DETAIL
  const fb_detail *d = fb_detail_last();
  const char *colon = strchr(d->what, ':');
  const int head = d->index >= 0 && colon ? (int)(colon - d->what) : 0, bound = refusal_has_bound(d->what);
  size_t n = 0;
  if (status == FB_OK || d->status != status) {
    return;
  }
  n += (size_t)snprintf(text, REFUSAL_LENGTH, " (%.60s: ", d->function);
  if (d->part >= 0) {
    n += (size_t)snprintf(text + n, REFUSAL_LENGTH - n, "part %d: ", d->part);
  }
  if (head > 0) {
    n += (size_t)snprintf(text + n, REFUSAL_LENGTH - n, "%.*s %d", head < 40 ? head : 40, d->what, d->index);
  }
  n += (size_t)snprintf(text + n, REFUSAL_LENGTH - n, "%.200s", d->what + head);
  if (bound) {
    n += (size_t)snprintf(text + n, REFUSAL_LENGTH - n, " %.5g: %.5g", (double)d->need, (double)d->have);
  } else if (!(d->have == 0)) {
    n += (size_t)snprintf(text + n, REFUSAL_LENGTH - n, ": %.5g", (double)d->have);
  }
  if (!(d->at == 0)) {
    n += (size_t)snprintf(text + n, REFUSAL_LENGTH - n, ", at %.5g", (double)d->at);
  }
  snprintf(text + n, REFUSAL_LENGTH - n, ")");
#else
  (void)status;
#endif
}

/* The same in a text of its own, until the next one. */
static inline const char *refusal_detail(fb_status status)
{
  static char text[REFUSAL_LENGTH];
  refusal_write(text, status);
  return text;
}

/* The text of a status with that. */
static inline const char *refusal_text(fb_status status)
{
  static char text[768];
  snprintf(text, sizeof text, "%s%s", fb_status_string(status), refusal_detail(status));
  return text;
}
#endif
