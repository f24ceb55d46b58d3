/* options.h - options `--name value` of an example. Define PROGRAM, its name, before. */
#ifndef OPTIONS_H
#define OPTIONS_H
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct number_option {
  const char *name;
  double *value, least, most;
} number_option;

#define NO_SUCH_OPTION (-1)

static int fail(const char *what, const char *value)
{
  fprintf(stderr, PROGRAM ": %s%s%s (see --help)\n", what, value[0] ? ": " : "", value);
  return 2;
}

/* A number of the list; NO_SUCH_OPTION if it is none of them, 2 after a message. */
static inline int read_number(const number_option *list, int n, const char *name, const char *text)
{
  for (int k = 0; k < n; k++) {
    if (strcmp(name, list[k].name) == 0) {
      char *end, message[96];
      double x;
      errno = 0;
      x = strtod(text, &end);
      if (end == text || *end || errno || !isfinite(x)) {
        snprintf(message, sizeof message, "%s wants a number", name);
        return fail(message, text);
      }
      if (x < list[k].least || x > list[k].most) {
        snprintf(message, sizeof message, "%s is %g to %g", name, list[k].least, list[k].most);
        return fail(message, text);
      }
      *list[k].value = x;
      return 0;
    }
  }
  return NO_SUCH_OPTION;
}

/* Numbers with commas between, at most `most`, each of at most 1e12: how many there were, 0 if it is no such list. */
static inline int read_list(double *x, int most, const char *text)
{
  const char *at = text;
  for (int n = 0; n < most; n++) {
    char *end;
    x[n] = strtod(at, &end);
    if (end == at || !(fabs(x[n]) <= 1e12) || (*end && *end != ',')) {
      return 0;
    }
    if (!*end) {
      return n + 1;
    }
    at = end + 1;
  }
  return 0;
}

/* A vector: three numbers, or one along z. */
static inline int read_vector(double x[3], const char *name, const char *text)
{
  double list[3];
  char message[96];
  const int n = read_list(list, 3, text);
  if (n != 1 && n != 3) {
    snprintf(message, sizeof message, "%s wants one number, or three with commas between", name);
    return fail(message, text);
  }
  for (int i = 0; i < 3; i++) {
    x[i] = n == 3 ? list[i] : i == 2 ? list[0] : 0;
  }
  return 0;
}

/* Takes an option without a value out of the arguments: 1 if it was there. */
static inline int take_flag(int *argc, char **argv, const char *name)
{
  int n = 0;
  for (int k = 0; k < *argc; k++) {
    if (k == 0 || strcmp(argv[k], name) != 0) {
      argv[n++] = argv[k];
    }
  }
  if (n == *argc) {
    return 0;
  }
  *argc = n;
  return 1;
}

/* The place of text among names, which stand between bars. */
static inline int read_choice(int *value, const char *name, const char *text, const char *names)
{
  char message[128];
  int k = 0;
  for (const char *p = names; *p; k++) {
    const size_t length = strcspn(p, "|");
    if (strlen(text) == length && strncmp(p, text, length) == 0) {
      *value = k;
      return 0;
    }
    p += length + (p[length] == '|');
  }
  snprintf(message, sizeof message, "%s wants one of %s", name, names);
  return fail(message, text);
}

/* --out FILE, with room for what is put behind the name. */
static inline int read_out(const char **out, const char *text)
{
  *out = text;
  return text[0] && strlen(text) < 400 ? 0 : fail("--out wants a file name of less than 400 characters", "");
}

/* All options: each goes to `read`, which returns 0, NO_SUCH_OPTION, or 2 after a message. */
static inline int read_all(int argc, char **argv, const char *help,
                           int (*read)(void *options, const char *name, const char *text), void *options)
{
  for (int i = 1; i < argc; i += 2) {
    int status;
    if (strcmp(argv[i], "--help") == 0) {
      fputs(help, stdout);
      exit(0);
    }
    if (argv[i][0] != '-') {
      return fail("no option (a FILE goes first)", argv[i]);
    }
    if (i + 1 == argc || strncmp(argv[i + 1], "--", 2) == 0) {
      return fail("no such option, or its value is missing", argv[i]);
    }
    status = read(options, argv[i], argv[i + 1]);
    if (status != 0) {
      return status == NO_SUCH_OPTION ? fail("unknown option", argv[i]) : status;
    }
  }
  return 0;
}
#endif
