/* spinup - spin-up of a flexible beam by its hub, the classical test of geometric stiffening.
   The hub turns with Omega(t) = spin/ramp (t - ramp/(2 pi) sin(2 pi t/ramp)) up to t = ramp, then with spin; the beam is
   clamped to it at the axis. Without --modes or --effects the program compares numbers of modes and sets of effects with
   a geometrically exact reference (--reference) or with its own richest model; with one of them it runs that model alone.
   Exit: 0 well, 1 a check failed or the motion left the model, 2 bad options. */
#define _POSIX_C_SOURCE 200809L /* popen, for gnuplot */
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define PI 3.14159265358979323846
#define MAX_ROWS 200001

typedef struct options {
  double length, mass, ei, ea, spin, ramp, t_end, dt; /* [m], [kg], [N m^2], [N], [rad/s], [s], [s], [s] */
  int modes;                                          /* -1: table */
  int effects;                                        /* -1: table */
  const char *out, *reference;
} options;

typedef struct history { /* one run */
  int rows;
  double t[MAX_ROWS], tip_x[MAX_ROWS], tip_y[MAX_ROWS], omega[MAX_ROWS], energy[MAX_ROWS];
  fb_status status; /* of the step that ended it */
  double t_stop;    /* [s] reached */
  double ns;        /* [ns] per step, drive included */
} history;

typedef struct effect_name {
  const char *name;
  unsigned mask;
} effect_name;

static const effect_name effect_names[] = {
    {"rigid", FB_EFFECTS_RIGID},
    {"linear", FB_EFFECTS_LINEAR},
    {"spin-coupling", FB_EFFECT_ELASTIC | FB_EFFECT_SPIN_COUPLING},
    {"residual-inertia", FB_EFFECT_ELASTIC | FB_EFFECT_RESIDUAL_INERTIA},
    {"spin-stiffening", FB_EFFECT_ELASTIC | FB_EFFECT_SPIN_STIFFENING},
    {"acceleration-stiffening", FB_EFFECT_ELASTIC | FB_EFFECT_ACCELERATION_STIFFENING},
    {"full", FB_EFFECTS_FULL},
};
#define EFFECT_NAMES ((int)(sizeof effect_names / sizeof effect_names[0]))

static const char help[] =
    "spinup - spin-up of a flexible beam by its hub\n"
    "usage: spinup [options]\n"
    "  --length L        [m] beam length (10)\n"
    "  --mass M          [kg] beam mass, uniform (12)\n"
    "  --ei EI           [N m^2] bending stiffness (14004)\n"
    "  --ea EA           [N] axial stiffness (31724000); stretch is left out: it enters no bending mode\n"
    "  --spin W          [rad/s] final hub rate (6)\n"
    "  --ramp T          [s] time to reach it (15)\n"
    "  --t-end T         [s] end of the run (30)\n"
    "  --dt DT           [s] step of rk4 (0.001, or 0.8 of the stability limit if that is less); refused beyond the "
    "limit\n"
    "  --modes N         bending modes, 0..12; alone: that model with the full set of effects\n"
    "  --effects A[,B]   any of rigid, linear, spin-coupling, residual-inertia, spin-stiffening,\n"
    "                    acceleration-stiffening, full; alone: with 3 modes\n"
    "  --out FILE        CSV: t [s], tip_x, tip_y [m], omega_z [rad/s], energy [J] (spinup.csv)\n"
    "  --reference FILE  CSV with columns t, GE_u2 to compare with (none: the richest model here)\n"
    "  --help            this text\n"
    "Without --modes and --effects: a table of models, the CSV of 3 modes with all effects (and beside it _linear.csv\n"
    "and _split.csv), and a picture (SVG) when gnuplot is installed. Deflections above about 15 % of the length are\n"
    "beyond the model's accuracy.\n";

static int fail(const char *what, const char *value)
{
  fprintf(stderr, "spinup: %s%s%s (see --help)\n", what, value[0] ? ": " : "", value);
  return 2;
}

static int read_number(double *x, const char *name, const char *text, double least, int open)
{
  char *end;
  char message[96];
  errno = 0;
  *x = strtod(text, &end);
  if (end == text || *end || errno || !isfinite(*x)) {
    snprintf(message, sizeof message, "%s wants a number", name);
    return fail(message, text);
  }
  if (*x < least || (open && *x <= least)) {
    snprintf(message, sizeof message, "%s must be %s %g", name, open ? "greater than" : "at least", least);
    return fail(message, text);
  }
  return 0;
}

static int read_modes(int *n, const char *text)
{
  char *end;
  const long value = strtol(text, &end, 10);
  if (end == text || *end || value < 0 || value > FB_MAX_MODES) {
    return fail("--modes wants a whole number from 0 to 12", text);
  }
  *n = (int)value;
  return 0;
}

static int read_effects(int *mask, const char *text)
{
  unsigned sum = 0;
  for (const char *p = text;; p++) {
    const size_t length = strcspn(p, ",");
    int found = 0;
    for (int k = 0; k < EFFECT_NAMES; k++) {
      if (strlen(effect_names[k].name) == length && strncmp(effect_names[k].name, p, length) == 0) {
        sum |= effect_names[k].mask;
        found = 1;
      }
    }
    if (!found) {
      return fail("--effects does not know this name", p);
    }
    p += length;
    if (*p == 0) {
      break;
    }
  }
  *mask = (int)sum;
  return 0;
}

static int read_options(options *o, int argc, char **argv)
{
  struct {
    const char *name;
    double *value;
    double least;
    int open;
  } numbers[] = {{"--length", &o->length, 0, 1}, {"--mass", &o->mass, 0, 1},    {"--ei", &o->ei, 0, 1},
                 {"--ea", &o->ea, 0, 0},         {"--spin", &o->spin, -1e6, 0}, {"--ramp", &o->ramp, 0, 1},
                 {"--t-end", &o->t_end, 0, 1},   {"--dt", &o->dt, 0, 1}};
  for (int i = 1; i < argc; i += 2) {
    const char *name = argv[i];
    int status = -1;
    if (strcmp(name, "--help") == 0) {
      fputs(help, stdout);
      exit(0);
    }
    if (i + 1 == argc) {
      return fail("no such option, or its value is missing", name);
    }
    for (int k = 0; k < (int)(sizeof numbers / sizeof numbers[0]); k++) {
      if (strcmp(name, numbers[k].name) == 0) {
        status = read_number(numbers[k].value, name, argv[i + 1], numbers[k].least, numbers[k].open);
      }
    }
    if (strcmp(name, "--modes") == 0) {
      status = read_modes(&o->modes, argv[i + 1]);
    } else if (strcmp(name, "--effects") == 0) {
      status = read_effects(&o->effects, argv[i + 1]);
    } else if (strcmp(name, "--out") == 0 || strcmp(name, "--reference") == 0) {
      *(name[2] == 'o' ? &o->out : &o->reference) = argv[i + 1];
      status = argv[i + 1][0] ? 0 : fail("empty file name", name);
    }
    if (status != 0) {
      return status > 0 ? status : fail("unknown option", name);
    }
  }
  if (strlen(o->out) > 400) {
    return fail("--out: the name is longer than 400 characters", "");
  }
  if (strlen(o->out) > 4 && strcmp(o->out + strlen(o->out) - 4, ".svg") == 0) {
    return fail("--out names the CSV; the picture gets its name with .svg", o->out);
  }
  return 0;
}

/* ---- the model */

static fb_beam beam;
static fb_modes modes;
static fb_modes_work modes_work;
static fb_shape shape;
static fb_body body;
static fb_body_work body_work;

static fb_status build(const options *o, int n_modes, unsigned effects, int *tip)
{
  static fb_beam_desc beam_desc;
  static fb_body_desc body_desc;
  fb_modes_desc keep;
  fb_status status;
  memset(&beam_desc, 0, sizeof beam_desc);
  beam_desc.length = (fb_real)o->length;
  beam_desc.n_element = FB_MAX_ELEMENTS;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = (fb_real)(o->mass / o->length);
  beam_desc.station[0].EA = (fb_real)o->ea;
  beam_desc.station[0].EI_z = (fb_real)o->ei;
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Y] = n_modes;
  memset(&body_desc, 0, sizeof body_desc);
  body_desc.effects = effects;
  body_desc.base = FB_BASE_PRESCRIBED;
  body_desc.allow_split_effects = 1; /* to show what they do; main() says so */
  status = fb_beam_init(&beam, &beam_desc);
  status = status ? status : fb_modes_solve(&modes, &modes_work, &beam, &keep);
  status = status ? status : fb_shape_init(&shape, modes.n);
  status = status ? status : fb_shape_add_beam(&shape, 0, &beam, &modes);
  status = status ? status : fb_shape_add_beam_node(&shape, tip, 0, &beam, &modes, beam_desc.length);
  return status ? status : fb_body_init(&body, &body_work, &shape, &body_desc);
}

static void drive(fb_input *input, const options *o, double t)
{
  const double turn = 2 * PI / o->ramp;
  const int on = t < o->ramp;
  input->w[2] = (fb_real)(on ? o->spin / o->ramp * (t - sin(turn * t) / turn) : o->spin);
  input->w_dot[2] = (fb_real)(on ? o->spin / o->ramp * (1 - cos(turn * t)) : 0.0);
}

static void record(history *h, const fb_state *state, const fb_input *input, int tip, double t)
{
  fb_motion motion;
  fb_node_motion node;
  fb_energy energy;
  if (fb_body_motion(&body, &motion, state, input) == FB_OK &&
      fb_body_node_motion(&body, &node, state, &motion, tip) == FB_OK &&
      fb_body_energy(&body, &energy, state, input) == FB_OK) {
    h->t[h->rows] = t;
    h->tip_x[h->rows] = (double)node.displacement[0];
    h->tip_y[h->rows] = (double)node.displacement[1];
    h->omega[h->rows] = (double)input->w[2];
    h->energy[h->rows++] = (double)(energy.kinetic + energy.strain);
  }
}

/* Runs the model; stride 0 only times it. */
static void run(history *h, const options *o, int tip, long steps, long stride)
{
  const double dt = o->t_end / (double)steps;
  fb_state state;
  fb_rk4_work work;
  fb_input input[3];
  clock_t start;
  memset(input, 0, sizeof input);
  (void)fb_state_init(&body, &state);
  h->status = FB_OK;
  start = clock();
  if (stride) {
    h->rows = 0;
    record(h, &state, &input[0], tip, 0.0);
  }
  h->t_stop = o->t_end;
  for (long k = 0; k < steps; k++) {
    const double t = (double)k * dt;
    drive(&input[1], o, t + 0.5 * dt);
    drive(&input[2], o, t + dt);
    h->status = fb_rk4_step(&body, &state, &work, &input[0], &input[1], &input[2], (fb_real)dt);
    if (h->status != FB_OK) {
      h->t_stop = t;
      steps = k + 1;
      break;
    }
    input[0] = input[2];
    if (stride && (k + 1) % stride == 0) {
      record(h, &state, &input[0], tip, t + dt);
    }
  }
  if (!stride) {
    h->ns = 1e9 * (double)(clock() - start) / CLOCKS_PER_SEC / (double)steps;
  }
}

/* ---- comparison and output */

typedef struct series {
  int rows;
  double t[MAX_ROWS], y[MAX_ROWS];
} series;

static int read_reference(series *s, const char *path)
{
  static char line[16384];
  int t_column = -1, y_column = -1;
  FILE *file = fopen(path, "r");
  s->rows = 0;
  if (!file) {
    return fail("cannot read the reference", path);
  }
  while (fgets(line, sizeof line, file) && s->rows < MAX_ROWS) {
    const int header = t_column < 0;
    int column = 0;
    if (line[0] == '#') {
      continue;
    }
    for (char *p = strtok(line, ",\r\n"); p; p = strtok(NULL, ",\r\n"), column++) {
      if (header) {
        t_column = strcmp(p, "t") == 0 ? column : t_column;
        y_column = strcmp(p, "GE_u2") == 0 ? column : y_column;
      } else if (column == t_column) {
        s->t[s->rows] = strtod(p, NULL);
      } else if (column == y_column) {
        s->y[s->rows] = strtod(p, NULL);
      }
    }
    s->rows += !header;
    if (header && (t_column < 0 || y_column < 0)) {
      break;
    }
  }
  fclose(file);
  return s->rows > 1 ? 0 : fail("the reference has no columns t and GE_u2", path);
}

/* Tip deflection of a run at time t; linear between rows. */
static double tip_at(const history *h, double t)
{
  const double x = t / h->t[h->rows - 1] * (h->rows - 1);
  int k = (int)x;
  k = k < 0 ? 0 : k > h->rows - 2 ? h->rows - 2 : k;
  return h->tip_y[k] + (t - h->t[k]) / (h->t[k + 1] - h->t[k]) * (h->tip_y[k + 1] - h->tip_y[k]);
}

/* Largest difference of the tip deflection up to the end of both, relative to the reference's peak. */
static double tip_error(const history *h, const series *reference)
{
  double error = 0.0, peak = 0.0;
  for (int k = 0; k < reference->rows; k++) {
    peak = fmax(peak, fabs(reference->y[k]));
    if (reference->t[k] <= h->t[h->rows - 1] * (1 + 1e-12) && h->rows > 1) {
      error = fmax(error, fabs(tip_at(h, reference->t[k]) - reference->y[k]));
    }
  }
  return peak > 0 ? error / peak : 0.0;
}

static int write_csv(const history *h, const char *path)
{
  FILE *file = fopen(path, "w");
  int ok = file != NULL;
  if (file) {
    ok = fprintf(file, "t,tip_x,tip_y,omega_z,energy\n") > 0;
    for (int k = 0; k < h->rows && ok; k++) {
      ok = fprintf(file, "%.10g,%.10g,%.10g,%.10g,%.10g\n", h->t[k], h->tip_x[k], h->tip_y[k], h->omega[k],
                   h->energy[k]) > 0;
    }
    ok = fclose(file) == 0 && ok;
  }
  return ok ? 0 : fail("cannot write", path);
}

/* path with its ending replaced */
static void other_name(char *name, size_t size, const char *path, const char *ending)
{
  const char *dot = strrchr(path, '.');
  const char *slash = strrchr(path, '/');
  const int length = (int)(dot && (!slash || dot > slash) ? (size_t)(dot - path) : strlen(path));
  snprintf(name, size, "%.*s%s", length, path, ending);
}

/* A name in gnuplot's quotes. */
static void put_quoted(FILE *gnuplot, const char *name)
{
  fputs("'", gnuplot);
  for (const char *p = name; *p; p++) {
    fputs(*p == '\'' ? "''" : (const char[2]){*p, 0}, gnuplot);
  }
  fputs("'", gnuplot);
}

static void plot_line(FILE *gnuplot, const char *file, const char *columns, const char *style, const char *title,
                      const char *end)
{
  put_quoted(gnuplot, file);
  fprintf(gnuplot, " using %s %s title '%s'%s\n", columns, style, title, end);
}

static void draw(const options *o, const char *full, const char *linear, const char *split)
{
  char svg[512];
  FILE *gnuplot;
  other_name(svg, sizeof svg, o->out, ".svg");
  if (system("gnuplot --version >/dev/null 2>&1") != 0) {
    printf("no picture: gnuplot is not installed (Debian: apt-get install gnuplot-nox); the CSV has the curves\n");
    return;
  }
  gnuplot = popen("gnuplot", "w");
  if (!gnuplot) {
    printf("no picture: gnuplot did not start\n");
    return;
  }
  fprintf(gnuplot, "set terminal svg size 900,520 font 'Helvetica,14' background '#ffffff'\nset output ");
  put_quoted(gnuplot, svg);
  fprintf(gnuplot,
          "\nset datafile separator ','\nset datafile commentschars '#'\nset key bottom right\nset grid\n"
          "set xlabel 'time [s]'\nset ylabel 'tip deflection [m]'\nset yrange [%g:%g]\n"
          "set title 'Spin-up of a flexible beam: what each effect does to the tip'\nplot \\\n",
          -0.1 * o->length, 0.03 * o->length);
  plot_line(gnuplot, full, "1:3", "every ::1 with lines lw 2 lc rgb '#0060ad'", "3 modes, all effects", ",\\");
  plot_line(gnuplot, linear, "1:3", "every ::1 with lines lw 2 lc rgb '#888888'", "3 modes, linear", ",\\");
  plot_line(gnuplot, split, "1:3", "every ::1 with lines lw 2 lc rgb '#dd181f'",
            "3 modes, softening without stiffening", o->reference ? ",\\" : "");
  if (o->reference) {
    plot_line(gnuplot, o->reference, "(column(\"t\")):(column(\"GE_u2\"))", "with points pt 6 ps 0.6 lc rgb '#000000'",
              "geometrically exact reference", "");
  }
  printf(pclose(gnuplot) == 0 ? "picture: %s\n" : "no picture: gnuplot refused (%s)\n", svg);
}

/* ---- the two ways to run */

static history result;
static series target;

/* The step where none was asked for, and a bound on their number. */
static int choose_step(options *o)
{
  int tip;
  const int n = o->modes >= 0 ? o->modes : o->effects >= 0 ? 3 : 6;
  const fb_status status = build(o, n, FB_EFFECTS_FULL, &tip);
  if (status != FB_OK) {
    return fail("cannot build the model", fb_status_string(status));
  }
  if (o->dt <= 0) {
    o->dt = fmin(0.001, 0.8 * (double)fb_rk4_limit(&body, (fb_real)o->spin, 0));
  }
  return o->t_end / o->dt > 1e8 ? fail("more than 1e8 steps: enlarge --dt or shorten --t-end", "") : 0;
}

static long steps_of(const options *o)
{
  return (long)ceil(o->t_end / o->dt * (1 - 1e-12));
}

/* Rows about every hundredth of a second, so that the reference's times are among them. */
static long stride_of(const options *o, long steps)
{
  const double dt = o->t_end / (double)steps;
  long stride = (long)floor(0.01 / dt * (1 + 1e-9));
  const long most = steps / (MAX_ROWS - 2) + 1;
  stride = stride > most ? stride : most;
  while (stride > 1 && steps % stride) {
    stride--;
  }
  return stride > most ? stride : most;
}

static int simulate(const options *o, int n_modes, unsigned effects, int timed)
{
  int tip;
  const long steps = steps_of(o);
  const fb_status status = build(o, n_modes, effects, &tip);
  if (status != FB_OK) {
    return fail("cannot build the model", fb_status_string(status));
  }
  if (o->dt > (double)fb_rk4_limit(&body, (fb_real)o->spin, 0)) {
    char limit[64];
    snprintf(limit, sizeof limit, "%.4g s for %d modes", (double)fb_rk4_limit(&body, (fb_real)o->spin, 0), n_modes);
    return fail("--dt is longer than the stability limit of rk4", limit);
  }
  run(&result, o, tip, steps, stride_of(o, steps));
  result.ns = HUGE_VAL;
  for (int k = 0; timed && k < 3; k++) { /* the quietest of three */
    const double before = result.ns;
    run(&result, o, tip, steps, 0);
    result.ns = fmin(result.ns, before);
  }
  return 0;
}

static void print_row(const options *o, int n_modes, const char *name, double error)
{
  const double factor = 1e9 * o->t_end / (double)steps_of(o) / result.ns;
  char text[32];
  if (result.status == FB_OK) {
    snprintf(text, sizeof text, "%9.4f %%", 100 * error);
  } else {
    snprintf(text, sizeof text, "stops %5.2f s", result.t_stop);
  }
  printf("%5d  %-38s %13s %9.0f %12.0f  %s\n", n_modes, name, text, result.ns, factor,
         result.status == FB_OK ? "" : fb_status_string(result.status));
}

static int run_one(const options *o)
{
  const unsigned effects = o->effects < 0 ? FB_EFFECTS_FULL : (unsigned)o->effects;
  const int n = o->modes < 0 ? 3 : o->modes;
  int status;
  if (fb_effects_check(effects) != FB_OK) {
    printf("caution: %s\n", fb_status_string(fb_effects_check(effects)));
  }
  status = simulate(o, n, effects, 1);
  if (status == 0) {
    status = write_csv(&result, o->out);
  }
  if (status != 0) {
    return status;
  }
  printf("%d mode(s): %.0f ns per step, %.0f times real time; CSV: %s\n", n, result.ns,
         1e9 * o->t_end / (double)steps_of(o) / result.ns, o->out);
  if (o->reference) {
    printf("tip deflection: largest error %.4f %% of the reference's peak\n", 100 * tip_error(&result, &target));
  }
  if (result.status != FB_OK) {
    printf("stopped at t = %.3f s: %s\n", result.t_stop, fb_status_string(result.status));
    return 1;
  }
  return 0;
}

typedef struct level {
  const char *name;
  unsigned effects;
  const char *ending; /* of the CSV that 3 modes write; NULL: none */
} level;

static int run_table(const options *o)
{
  static const int counts[] = {0, 1, 2, 3, 6};
  static const unsigned inertia = FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA;
  const level levels[] = {{"linear", FB_EFFECTS_LINEAR, "_linear.csv"},
                          {"+ spin coupling", FB_EFFECTS_SPIN, NULL},
                          {"+ residual inertia (half an effect)", inertia, "_split.csv"},
                          {"+ spin stiffening", inertia | FB_EFFECT_SPIN_STIFFENING, NULL},
                          {"+ acceleration stiffening = full", FB_EFFECTS_FULL, ""}};
  char names[3][512];
  double full3 = 1.0;
  int stopped = 0, status = 0;
  status = simulate(o, 6, FB_EFFECTS_FULL, 0); /* the stiffest: its step limit before any output */
  if (status == 0) {
    status = write_csv(&result, o->out); /* the file can be written */
  }
  if (status != 0) {
    return status;
  }
  if (!o->reference) {
    target.rows = result.rows;
    memcpy(target.t, result.t, sizeof target.t);
    memcpy(target.y, result.tip_y, sizeof target.y);
  }
  printf("Spin-up to %g rad/s in %g s, beam %g m, %g kg, EI %g N m^2; rk4, step %g s\n", o->spin, o->ramp, o->length,
         o->mass, o->ei, o->t_end / (double)steps_of(o));
  printf("Error of the tip deflection in percent of the peak, against %s\n\n",
         o->reference ? "the geometrically exact reference" : "6 modes with all effects");
  printf("modes  effects                                        error   ns/step  x real time\n");
  for (int c = 0; c < 5 && status == 0; c++) {
    for (int k = 0; k < 5 && status == 0; k++) {
      if (counts[c] == 0 && k > 0) {
        break;
      }
      status = simulate(o, counts[c], levels[k].effects, 1);
      if (status == 0) {
        print_row(o, counts[c], counts[c] ? levels[k].name : "rigid", tip_error(&result, &target));
      }
      if (status == 0 && counts[c] == 3 && levels[k].ending) {
        char *name = names[k == 4 ? 0 : k == 0 ? 1 : 2];
        if (levels[k].ending[0]) {
          other_name(name, sizeof names[0], o->out, levels[k].ending);
        } else {
          snprintf(name, sizeof names[0], "%s", o->out);
        }
        status = write_csv(&result, name);
      }
      full3 = counts[c] == 3 && k == 4 && result.status == FB_OK ? tip_error(&result, &target) : full3;
      stopped += counts[c] == 3 && k == 2 && result.status == FB_ERR_RANGE;
    }
  }
  if (status != 0) {
    return status;
  }
  printf("\nfb_effects_check on the half effect: %s\n", fb_status_string(fb_effects_check(inertia)));
  printf("CSV: %s, %s, %s\n", names[0], names[1], names[2]);
  draw(o, names[0], names[1], names[2]);
  if (o->reference) {
    const int ok = full3 < 0.002 && stopped;
    printf("check: 3 modes with all effects within 0.2 %%: %.4f %%; the half effect stopped by a status: %s\n",
           100 * full3, stopped ? "yes" : "no");
    return ok ? 0 : 1;
  }
  return 0;
}

int main(int argc, char **argv)
{
  options o = {10, 12, 14004, 31724000, 6, 15, 30, 0, -1, -1, "spinup.csv", NULL};
  int status = read_options(&o, argc, argv);
  if (status == 0 && o.reference) {
    status = read_reference(&target, o.reference);
  }
  status = status ? status : choose_step(&o);
  if (status != 0) {
    return status;
  }
  status = o.modes < 0 && o.effects < 0 ? run_table(&o) : run_one(&o);
  if (fflush(stdout) != 0 && status == 0) {
    fprintf(stderr, "spinup: cannot write the output\n");
    status = 1;
  }
  return status;
}
