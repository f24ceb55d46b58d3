/* scene - runs a scene from a text file: bodies, joints, loads; to CSV, pictures and an animation. README.md, "Scenes",
   lists the words; examples/scenes/ holds scenes. Exit: 0 well, 1 the run failed, 2 bad options or file. */
#define _POSIX_C_SOURCE 200809L /* popen, for gnuplot */
#include "scene_run.h"
#define PROGRAM "scene"
#include "options.h"

static const char help[] =
    "scene - runs a scene from a text file (words: README.md, \"Scenes\"; scenes: examples/scenes/)\n"
    "usage: scene FILE [options]\n"
    "  --set NAME=VALUE  another value of a parameter of the file; may be there many times\n"
    "  --out FILE        outputs as CSV\n"
    "  --help            this text\n";

typedef struct command {
  scene_options options;
  int n_set;
  char name[SCENE_PARAMETERS][TEXT_NAME];
  scene_setting set[SCENE_PARAMETERS];
} command;

static scene the_scene;

/* NAME=VALUE */
static int read_setting(command *c, const char *text)
{
  const size_t n = strcspn(text, "=");
  char *end;
  if (c->n_set == SCENE_PARAMETERS || n == 0 || n >= TEXT_NAME || text[n] != '=') {
    return fail("--set wants NAME=VALUE", text);
  }
  memcpy(c->name[c->n_set], text, n);
  c->set[c->n_set].name = c->name[c->n_set];
  c->set[c->n_set].value = strtod(text + n + 1, &end);
  if (*end || end == text + n + 1 || !isfinite(c->set[c->n_set].value)) {
    return fail("--set wants NAME=NUMBER", text);
  }
  c->n_set++;
  return 0;
}

static int read_option(void *to, const char *name, const char *text)
{
  command *const c = (command *)to;
  if (strcmp(name, "--set") == 0) {
    return read_setting(c, text);
  }
  return strcmp(name, "--out") == 0 ? read_out(&c->options.csv, text) : NO_SUCH_OPTION;
}

/* What was measured, and how far it is from what is known. */
static void tell(const scene *s)
{
  for (int k = 0; k < s->n_measure; k++) {
    printf("%s = %.9g\n", s->measure[k].label, s->measured[k]);
  }
  for (int k = 0; k < s->n_expectation; k++) {
    const scene_expectation *const e = &s->expectation[k];
    const double allowed = scene_allowed(e->tolerance, e->relative, fabs(e->value));
    printf("%s: %.3g from %.9g, allowed %.3g%s\n", s->measure[e->measure].label, e->difference, e->value, allowed,
           e->difference <= allowed ? "" : "  MISSED");
  }
  for (int k = 0; k < s->n_reference; k++) {
    const scene_reference *const r = &s->reference[k];
    const double allowed = scene_allowed(r->tolerance, r->relative, r->largest);
    printf("%s: %.3g at most from %d rows of the reference, of which the largest is %.6g; allowed %.3g%s\n",
           s->output[r->output].label, r->difference, r->compared, r->largest, allowed,
           r->compared > 0 && r->difference <= allowed ? "" : "  MISSED");
  }
}

int main(int argc, char **argv)
{
  static command c;
  scene *const s = &the_scene;
  int failed;
  if (argc < 2 || strcmp(argv[1], "--help") == 0) {
    fputs(help, argc < 2 ? stderr : stdout);
    return argc < 2 ? 2 : 0;
  }
  if (read_all(argc - 1, argv + 1, help, read_option, &c) != 0) {
    return 2;
  }
  c.options.talk = stdout;
  c.options.progress = stderr;
  failed = scene_read(s, argv[1], c.set, c.n_set) ? 2 : scene_run(s, &c.options);
  if (failed) {
    fprintf(stderr, "scene: %s\n", s->message);
    return failed;
  }
  tell(s);
  return s->missed > 0 ? 1 : 0;
}
