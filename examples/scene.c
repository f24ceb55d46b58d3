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

int main(int argc, char **argv)
{
  static command c;
  int failed;
  if (argc < 2 || strcmp(argv[1], "--help") == 0) {
    fputs(help, argc < 2 ? stderr : stdout);
    return argc < 2 ? 2 : 0;
  }
  if (read_all(argc - 1, argv + 1, help, read_option, &c) != 0) {
    return 2;
  }
  c.options.talk = stderr;
  failed = scene_read(&the_scene, argv[1], c.set, c.n_set) ? 2 : scene_run(&the_scene, &c.options);
  if (failed) {
    fprintf(stderr, "scene: %s\n", the_scene.message);
    return failed;
  }
  for (int k = 0; k < the_scene.n_measure; k++) {
    printf("%s = %.9g\n", the_scene.measure[k].label, the_scene.measured[k]);
  }
  return 0;
}
