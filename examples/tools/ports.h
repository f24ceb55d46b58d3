/* ports.h - inputs and outputs of a linear model from a command line, as force.tip.y: what the words that write one share.
   Define PROGRAM and include options.h, same_file.h and linear_out.h first. */
#ifndef PORTS_H
#define PORTS_H

static int fail_port(const char *option, const char *word, const char *why)
{
  fprintf(stderr, PROGRAM ": %s: %s: %s\n", option, word, why);
  return 2;
}

/* Which of the kinds the word begins with, up to its first dot; count: none. */
static int port_kind(const linear_port *list, int count, const char *word)
{
  const size_t length = strcspn(word, ".");
  int k = 0;
  while (k < count && (strlen(list[k].name) != length || strncmp(list[k].name, word, length) != 0)) {
    k++;
  }
  return k;
}

typedef struct port_place { /* KIND.PLACE.AXIS */
  int axis;
  size_t length; /* of.. */
  char at[80];   /* ..PLACE; empty: there is none */
} port_place;

/* 0, or 2 after a message. */
static int read_place(port_place *place, const char *option, const char *word)
{
  const char *const last = strrchr(word, '.'), *const first = strchr(word, '.');
  if (!last || strlen(last) != 2 || !strchr(linear_axes, last[1])) {
    return fail_port(option, word, "wants .x, .y or .z at its end");
  }
  place->axis = (int)(strchr(linear_axes, last[1]) - linear_axes);
  place->length = last > first ? (size_t)(last - first) - 1 : 0;
  snprintf(place->at, sizeof place->at, "%.*s", (int)place->length, first + 1);
  return 0;
}

/* A number below `count`; -1: it is none. */
static int port_number(const char *text, int count)
{
  char *end;
  const long number = strtol(text, &end, 10);
  return end != text && !*end && number >= 0 && number < count ? (int)number : -1;
}

/* Reads port k of `ports` from a word: 0, or 2 after a message. */
typedef int port_reader(void *ports, int k, const char *option, const char *word);

/* A list of ports, and their names as they are given. */
static int read_ports(void *ports, int *n, linear_value *names, const char *option, const char *list, port_reader *read)
{
  for (const char *at = list; *at;) {
    const size_t length = strcspn(at, ",");
    char word[80];
    if (*n == FB_MAX_PORTS || length >= sizeof word) {
      return fail_port(option, at, *n == FB_MAX_PORTS ? "more than 96 of them" : "is too long");
    }
    snprintf(word, sizeof word, "%.*s", (int)length, at);
    if (read(ports, *n, option, word)) {
      return 2;
    }
    memcpy(names[*n].name, word, sizeof word);
    at += length + (at[length] == ',');
    (*n)++;
  }
  return 0;
}

/* Writes the model, with the names as they were given, and tells of it: 0, or 2 after a message. */
static int write_ports(linear_out *file, const linear_value *in, const linear_value *out, const char *name)
{
  for (int k = 0; k < file->n_in; k++) {
    memcpy(file->in[k].name, in[k].name, sizeof in[k].name);
  }
  for (int k = 0; k < file->n_out; k++) {
    memcpy(file->out[k].name, out[k].name, sizeof out[k].name);
  }
  if (same_file(file->source, name)) {
    return fail("--linear: that is the description itself", name);
  }
  if (linear_out_write(file, name)) {
    fprintf(stderr, PROGRAM ": cannot write %s: %s%s\n", name, output_why(), output_left(name));
    return 2;
  }
  printf("linear model: %s, %d states, %d inputs, %d outputs\n", name, file->n, file->n_in, file->n_out);
  return 0;
}
#endif
