/* scene - runs a scene from a text file: bodies, joints, loads; to CSV, pictures and an animation. scenes/README.md
   lists the words; examples/scenes/ holds scenes. Exit: 0 well; 1 a reference is missed, the motion left the model or a
   file could not be written; 2 bad options, or a file that makes no sense; 130, 143: SIGINT, SIGTERM stopped the run. */
#define _POSIX_C_SOURCE 200809L /* popen, for gnuplot */
#include "scene_run.h"
#define PROGRAM "scene"
#include "../common/options.h"
#include "../tools/words.h"
#include "../common/output.h"
#include "../common/plot.h"
#include "scene_campbell.h"
#include "scene_code.h"
#include "scene_curves.h"
#include "scene_files.h"
#include <unistd.h>

static const char help[] =
    "scene - runs a scene from a text file (words and scenes: examples/scenes/)\n"
    "usage: flexbeam scene FILE [options]\n"
    "  --set NAME=VALUE  another value of a parameter of the file; may be there many times\n"
    "  --out FILE        outputs as CSV, FILE.part until the run ends; curves beside it as SVG where gnuplot is there\n"
    "  --margins FILE    response of the loops of controllers over frequency as CSV (Bode and Nyquist, as SVG beside\n"
    "                    it); prints their margins\n"
    "  --linear FILE     A, B, C, D about the start, with names and units: FILE.json, or CSV\n"
    "  --grid NAME FROM TO N   a model at N values of a parameter, into that file (JSON); up to 4 times: all "
    "combinations\n"
    "  --modes           prints the modes about the start, slowest first: frequency, damping, what moves, a name; "
    "does\n"
    "                    not run; with --animation FILE that of mode --mode N (1)\n"
    "  --campbell NAME FROM TO N   modes over N values of a parameter, followed by their shapes; table to --out FILE, "
    "its\n"
    "                    picture beside it, else to the terminal\n"
    "  --code FILE       writes the step of its bodies on joints as C of its own, FILE.h, and does not run: of sdirk\n"
    "                    where the scene says so, else of rk4; functions are called as FILE; with --single for single\n"
    "                    precision, with --lanes for several at once, too; with --loads LIST for a force and a\n"
    "                    torque at each of these nodes, BODY.NODE,.., which its load lines then are\n"
    "  --jacobian FILE   the rates of its tree of bodies and a step of rk4, with their exact Jacobians, as C of its "
    "own,\n"
    "                    for filters and controllers that predict; with --single and --loads LIST as above, and with\n"
    "                    --sensors LIST for what an IMU, a star tracker and a receiver see at each of these nodes\n"
    "  --picture FILE    SVG of a few positions over each other\n"
    "  --animation FILE  SVG that moves, for a browser\n"
    "  --frames FOLDER   numbered SVG files frame_0001.svg, ... (the folder is made where it is not there; its old\n"
    "                    frames go)\n"
    "  --frame-count N   of frames and animation, 2 to 480 (120)\n"
    "  --quiet           says nothing but what is missed or wrong\n"
    "  --help            this text\n"
    "prints what was chosen, the measures and the largest differences from references; exit 1: one is missed\n"
    "a file, to begin with (a body that spins and is pushed):\n"
    "  duration 10\n"
    "  body boom beam\n"
    "    length 10\n"
    "    stations x mass EI_y EI_z\n"
    "      0 1.2 14004 14004\n"
    "    end\n"
    "    hub 500  0 0 0  80 80 80\n"
    "    modes bend_y 3 bend_z 3\n"
    "    node tip tip\n"
    "    start_spin 0 0 1\n"
    "  end\n"
    "  load boom.tip base force 0 0 1 pulse 5 1 2\n"
    "  output tip displacement boom.tip\n"
    "  output hub spin boom z\n";

typedef struct command {
  scene_options options;
  scene_family family;
  const char *code, *jacobian;
  scene_code write;
  int n_set;
  char name[SCENE_PARAMETERS][TEXT_NAME];
  scene_setting set[SCENE_PARAMETERS];
} command;

static scene the_scene;

/* Takes --campbell or --grid NAME FROM TO N out of the arguments: 0, or 2 after a message. */
static int take_range(int *argc, char **argv, const char *option, scene_family *family, int most)
{
  const char *why = NULL;
  for (int k = 1; k < *argc; k++) {
    if (strcmp(argv[k], option) != 0) {
      continue;
    }
    if (family->n_range == most) {
      return fail(option, most > 1 ? "is there more than 4 times, or beside --campbell" : "is there twice");
    }
    if (k + 4 >= *argc || scene_range_read(&family->range[family->n_range++], argv + k + 1, &why)) {
      return fail(option, why ? why : "wants NAME FROM TO N");
    }
    memmove(argv + k, argv + k + 5, (size_t)(*argc - k - 5) * sizeof *argv);
    *argc -= 5;
    k--;
  }
  return 0;
}

/* NAME=VALUE */
static int read_setting(command *c, const char *text)
{
  const size_t n = strcspn(text, "=");
  char *end;
  if (c->n_set == SCENE_PARAMETERS) {
    return fail("more --set than a scene has parameters", text);
  }
  if (n == 0 || n >= TEXT_NAME || text[n] != '=') {
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
  if (strcmp(name, "--loads") == 0 || strcmp(name, "--sensors") == 0) {
    const char **const list = name[2] == 'l' ? &c->write.loads : &c->write.sensors;
    if (*list) {
      return fail("--loads and --sensors take all nodes at once, with commas", text);
    }
    *list = text;
    return 0;
  }
  if (strcmp(name, "--frame-count") == 0 || strcmp(name, "--mode") == 0) {
    const int is_mode = name[2] == 'm';
    double n = 0;
    const number_option list[] = {{name, &n, is_mode ? 1 : 2, is_mode ? SCENE_MODES : SCENE_FRAMES}};
    const int status = read_number(list, 1, name, text);
    *(is_mode ? &c->options.mode : &c->options.n_frame) = (int)n;
    return status || n == floor(n) ? status : fail("a whole number is wanted", name);
  }
  for (int k = 0; k < 8; k++) {
    const struct {
      const char *name, **file;
    } files[] = {{"--out", &c->options.csv},
                 {"--margins", &c->options.margins},
                 {"--linear", &c->options.linear},
                 {"--picture", &c->options.picture},
                 {"--animation", &c->options.animation},
                 {"--frames", &c->options.frames},
                 {"--code", &c->code},
                 {"--jacobian", &c->jacobian}};
    if (strcmp(name, files[k].name) == 0) {
      return read_out(files[k].file, text);
    }
  }
  return NO_SUCH_OPTION;
}

/* What was measured, and how far it is from what is known. */
static void tell(const scene *s, int quiet)
{
  for (int k = 0; k < s->n_measure && !quiet; k++) {
    printf("%s = %.9g\n", s->measure[k].label, s->measured[k]);
  }
  for (int k = 0; k < s->n_expectation; k++) {
    const scene_expectation *const e = &s->expectation[k];
    const double allowed = scene_allowed(e->tolerance, e->relative, fabs(e->value));
    if (quiet && e->difference <= allowed) {
      continue;
    }
    printf("%s: %.3g from %.9g, allowed %.3g%s\n", s->measure[e->measure].label, e->difference, e->value, allowed,
           e->difference <= allowed ? "" : "  MISSED");
  }
  for (int k = 0; k < s->n_reference; k++) {
    const scene_reference *const r = &s->reference[k];
    const double allowed = scene_allowed(r->tolerance, r->relative, r->largest);
    if (quiet && r->compared > 0 && r->difference <= allowed) {
      continue;
    }
    if (r->compared == 0) {
      printf("%s: no row of the reference is at the time of a row of the run  MISSED\n", s->output[r->output].label);
      continue;
    }
    printf("%s: %.3g at most from %d rows of the reference, of which the largest is %.6g; allowed %.3g%s\n",
           s->output[r->output].label, r->difference, r->compared, r->largest, allowed,
           r->difference <= allowed ? "" : "  MISSED");
  }
}

static volatile sig_atomic_t stopped; /* number of a signal */

/* Before the first row nobody looks at `stopped`, and there is nothing to be told. */
static void stop(int number)
{
  if (!the_scene.began) {
    output_stop(number);
  }
  stopped = number;
}

/* One that is ignored, as of a program in the background, stays so. */
static void watch_signals(void (*before)(int), void (*handler)(int))
{
  static const int numbers[] = {SIGINT, SIGTERM};
  struct sigaction now, then;
  memset(&then, 0, sizeof then);
  then.sa_handler = handler;
  then.sa_flags = SA_RESTART;
  for (int k = 0; k < 2; k++) {
    if (sigaction(numbers[k], NULL, &now) == 0 && now.sa_handler == before) {
      sigaction(numbers[k], &then, NULL);
    }
  }
}

/* Runs the scene; a status of main. The rows get their name when the run has ended, well or with a reason. */
static int run_scene(scene *s, const scene_options *o)
{
  scene_options to = *o;
  int failed;
  if (o->csv && !(to.rows = output_open(o->csv))) {
    char what[128];
    snprintf(what, sizeof what, "--out: %s", output_why());
    return fail(what, o->csv);
  }
  if (to.rows) {
    s->began = 0;
    to.stop = &stopped;
    watch_signals(output_stop, stop);
  }
  failed = !scene_run(s, &to) ? 0 : s->began ? 1 : 2;
  if (to.rows) {
    watch_signals(stop, output_stop);
  }
  if (to.rows && failed && stopped) {
    output_leave(to.rows, o->csv);
    return 128 + stopped;
  }
  if (to.rows && failed == 2) {
    output_drop(to.rows, o->csv); /* it has no row */
  } else if (to.rows && !output_is_whole(to.rows, o->csv) && !failed) {
    failed = scene_fail(s, "cannot write %s: %s%s", o->csv, strerror(errno), output_left(o->csv));
  }
  return failed;
}

/* The scene with its settings, to be read again. */
static void begin_family(command *c, const char *path)
{
  scene_family *const f = &c->family;
  f->s = &the_scene;
  f->path = path;
  f->n_set = c->n_set;
  memcpy(f->set, c->set, sizeof c->set);
}

/* Modes, or linear models, over parameters: a status of main. */
static int run_family(command *c, const char *path, int campbell, int quiet)
{
  const scene_options *const o = &c->options;
  const char *const linear = o->linear, *const ending = linear ? strrchr(linear, '.') : NULL;
  scene_family *const f = &c->family;
  int failed;
  begin_family(c, path);
  f->options.warn = stderr;
  if (o->margins || o->picture || o->animation || o->frames || c->code || c->jacobian || (campbell ? linear : o->csv)) {
    return fail(campbell ? "--campbell runs nothing: no file beside that of --out"
                         : "--grid runs nothing: no file beside that of --linear",
                "");
  }
  if (!campbell && (!ending || strcmp(ending, ".json") != 0)) {
    return fail("--grid is for --linear FILE.json", linear ? linear : "");
  }
  for (int r = 0; r < f->n_range; r++) {
    for (int k = 0; k < c->n_set + r; k++) {
      if (strcmp(f->range[r].name, k < c->n_set ? c->set[k].name : f->range[k - c->n_set].name) == 0) {
        return fail("a parameter over whose values models are wanted is set, too", f->range[r].name);
      }
    }
  }
  if (scene_files_check(path, o, campbell && o->csv && !quiet, NULL, NULL) != 0) {
    return 2;
  }
  failed = campbell ? scene_campbell(f, o->csv, !quiet) : scene_linear_family(f, linear, !quiet);
  if (failed) {
    fprintf(stderr, "scene: %s\n", f->s->message);
  }
  return failed && f->refused ? 2 : failed;
}

static int has_curves(const scene *s, const scene_options *o)
{
  return o->csv && o->talk && s->n_output > 0 && s->duration > 0 && output_is_plain(o->csv);
}

static int measures_frequency(const scene *s)
{
  int is = 0;
  for (int k = 0; k < s->n_measure; k++) {
    is |= s->measure[k].kind == SCENE_FREQUENCY;
  }
  return is;
}

int scene_main(int argc, char **argv)
{
  static command c;
  scene *const s = &the_scene;
  const int quiet = take_flag(&argc, argv, "--quiet"), single = take_flag(&argc, argv, "--single"),
            lanes = take_flag(&argc, argv, "--lanes"), modes = take_flag(&argc, argv, "--modes");
  int failed, campbell = 0;
  output_begin(PROGRAM);
  if (argc < 2 || strcmp(argv[1], "--help") == 0) {
    fputs(help, argc < 2 ? stderr : stdout);
    return argc < 2 ? 2 : 0;
  }
  if (take_range(&argc, argv, "--campbell", &c.family, 1) ||
      (campbell = c.family.n_range, take_range(&argc, argv, "--grid", &c.family, campbell ? 1 : FAMILY_PARAMETERS)) ||
      read_all(argc - 1, argv + 1, help, read_option, &c) != 0) {
    return 2;
  }
  c.options.talk = quiet || modes ? NULL : stdout;
  c.options.modes = modes;
  c.options.warn = stderr;
  c.options.progress = quiet ? NULL : stderr;
  c.options.live = isatty(2);
  if (c.family.n_range > 0) {
    return run_family(&c, argv[1], campbell, quiet);
  }
  failed = scene_read(s, argv[1], c.set, c.n_set) ? 2 : 0;
  c.write.file = c.code ? c.code : c.jacobian;
  c.write.single = single;
  c.write.lanes = lanes;
  c.write.jacobian = c.jacobian != NULL;
  if (!failed &&
      ((lanes && !c.code) || (c.write.sensors && !c.jacobian) || ((single || c.write.loads) && !c.write.file))) {
    return fail(lanes             ? "--lanes belongs to --code"
                : c.write.sensors ? "--sensors belongs to --jacobian"
                : single          ? "--single belongs to --code or --jacobian"
                                  : "--loads belongs to --code or --jacobian",
                "");
  }
  if (!failed && (c.write.file || modes) &&
      (c.options.csv || c.options.margins || c.options.linear || c.options.picture || (c.options.animation && !modes) ||
       c.options.frames || (c.code != NULL) + (c.jacobian != NULL) + modes > 1)) {
    return fail(c.code       ? "--code runs nothing: no other file beside it"
                : c.jacobian ? "--jacobian runs nothing: no other file beside it"
                             : "--modes runs nothing: no file beside it but --animation",
                "");
  }
  if (!failed && c.options.mode > 0 && !(modes && c.options.animation)) {
    return fail("--mode is for --modes with --animation FILE", "");
  }
  if (!failed && scene_files_check(argv[1], &c.options, has_curves(s, &c.options), c.code, c.jacobian) != 0) {
    return 2;
  }
  failed = failed ? failed : c.write.file ? scene_write_code(s, &c.write) : run_scene(s, &c.options);
  if (failed) {
    if (s->message[0]) {
      fprintf(stderr, "scene: %s\n", s->message);
    }
    return failed;
  }
  if (c.write.file) {
    return 0;
  }
  if (modes) {
    begin_family(&c, argv[1]);
    scene_tell_rest(&c.family, NULL);
    return 0;
  }
  tell(s, quiet);
  if (has_curves(s, &c.options)) {
    draw_curves(s, c.options.csv);
  }
  if (c.options.margins && !quiet && output_is_plain(c.options.margins)) {
    draw_margins(s, c.options.margins);
  }
  failed = s->missed > 0;
  if (measures_frequency(s)) {
    begin_family(&c, argv[1]);
    scene_tell_rest(&c.family, NULL);
  }
  return failed;
}
