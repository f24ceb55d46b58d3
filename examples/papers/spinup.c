/* spinup - spin-up of a flexible beam by its hub, the classical test of geometric stiffening.
   The hub turns with Omega(t) = spin/ramp (t - ramp/(2 pi) sin(2 pi t/ramp)) up to t = ramp, then with spin, and the
   beam is clamped to it at the axis; or a torque G (1 - cos(2 pi t/ramp)) turns the hinged beam. Without options that
   choose a model the program compares numbers of modes and sets of effects with a geometrically exact reference
   (--reference) or with its own richest model; with one of them it runs that model alone.
   Exit: 0 well, 1 a check failed or the motion left the model, 2 bad options. */
#define _POSIX_C_SOURCE 200809L /* popen, for gnuplot */
#define PROGRAM "spinup"
#include "spinup_model.h"
#include "../common/plot.h"
#include "../common/output.h"

#define MAX_BENDING 12 /* modes per plane on the command line */
#define NOT_GIVEN (-1)

typedef struct options {
  scene scene;
  int alone;                                               /* an option that chooses a model was given */
  int modes, effects, elements, polynomial, basis, planes; /* as given */
  int form, torque_form, degree, integrator, drive, after;
  double spin, torque;
  const char *out, *reference;
} options;

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
    {"large", FB_EFFECTS_LARGE},
};
#define EFFECT_NAMES ((int)(sizeof effect_names / sizeof effect_names[0]))

static const char help[] =
    "spinup - spin-up of a flexible beam by its hub\n"
    "usage: spinup [options]\n"
    "the beam\n"
    "  --length L        [m] beam length (10)\n"
    "  --mass M          [kg] beam mass, uniform (12)\n"
    "  --ei EI           [N m^2] bending stiffness (14004)\n"
    "  --ea EA           [N] axial stiffness (31724000); it enters with --elements only\n"
    "its motion\n"
    "  --drive hub|torque  the rate of the hub is prescribed, or a torque turns the hinged beam (hub)\n"
    "  --spin W          [rad/s] final rate of the hub (6)\n"
    "  --torque G        [N m] amplitude of the torque (160)\n"
    "  --after zero|hold  the torque after the ramp: zero, or G, as the paper prints it (zero)\n"
    "  --ramp T          [s] duration of the ramp (15)\n"
    "  --t-end T         [s] end of the run (30)\n"
    "the model: modes with the quadratic displacement\n"
    "  --modes N         bending modes, 0..12 (3)\n"
    "  --effects A[,B]   any of rigid, linear, spin-coupling, residual-inertia, spin-stiffening,\n"
    "                    acceleration-stiffening, full, large (full)\n"
    "the model: axial coordinates with nonlinear strain, [DB] section 4\n"
    "  --elements N      elements per direction, 1..20, instead of --modes; up to 40 coordinates\n"
    "  --polynomial P    degree of the functions in an element, 3..8 (3)\n"
    "  --basis open|closed  the axial strain at the root is free, or zero: the same functions in every direction "
    "(open)\n"
    "  --degree 0|1|2|3  highest degree Q of the terms kept, [DB] figures 4 and 5 (3: all)\n"
    "both models\n"
    "  --planes 1|2      bending in the plane of the motion, or in both (1)\n"
    "  --form momentum|second|first  equations of motion (momentum)\n"
    "  --torque-form identity|printed|boundary  stiffness torque of the first-order form, with --elements (identity)\n"
    "the computation\n"
    "  --integrator NAME     one of %s (rk4)\n"
    "  --dt DT           [s] step, refused beyond the limit of the integrator (rk4 0.001, midpoint 0.0025, others "
    "0.005, "
    "or 0.8 of "
    "the\n"
    "                    stability limit of the undeflected body if that is less; with --elements 0.7)\n"
    "  --out FILE        CSV: t [s], tip_x, tip_y [m], omega_z [rad/s], energy [J]; with --drive torque its work [J]\n"
    "                    (spinup.csv)\n"
    "  --reference FILE  CSV with columns t, GE_u2 to compare with (none: the richest model here)\n"
    "  --help            this text\n"
    "Without --modes, --effects, --elements, --planes, --form, --integrator, --drive: a table of models, the CSV of 3 "
    "modes with\n"
    "all effects (and beside it _linear.csv and _split.csv), and a picture (SVG) when gnuplot is installed. With one "
    "of them:\n"
    "that model alone. Deflections above about 15 %% of the length are beyond the accuracy of all effects but large.\n"
    "[DB] D'Eleuterio and Barfoot, Just a second, we'd like to go first.\n";

static int read_bounded(double *x, const char *name, const char *text, double least, int open)
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

static const char *integrator_names(void)
{
  static char names[128];
  names[0] = 0;
  for (int k = 0; k < INTEGRATORS; k++) {
    const size_t length = strlen(names);
    snprintf(names + length, sizeof names - length, "%s%s", k ? "|" : "", integrators[k].name);
  }
  return names;
}

/* One option; -1: there is none of this name. */
static int read_option(options *o, const char *name, const char *text)
{
  scene *s = &o->scene;
  struct {
    const char *name;
    double *value;
    double least;
    int open;
  } numbers[] = {{"--length", &s->length, 0, 1}, {"--mass", &s->mass, 0, 1},    {"--ei", &s->ei, 0, 1},
                 {"--ea", &s->ea, 0, 0},         {"--spin", &o->spin, -1e6, 0}, {"--torque", &o->torque, -1e9, 0},
                 {"--ramp", &s->ramp, 0, 1},     {"--t-end", &s->t_end, 0, 1},  {"--dt", &s->dt, 0, 1}};
  struct {
    const char *name, *names;
    int *value;
  } choices[] = {{"--drive", "hub|torque", &o->drive},
                 {"--after", "zero|hold", &o->after},
                 {"--basis", "open|closed", &o->basis},
                 {"--degree", "0|1|2|3", &o->degree},
                 {"--planes", "1|2", &o->planes},
                 {"--form", "momentum|second|first", &o->form},
                 {"--torque-form", "identity|printed|boundary", &o->torque_form},
                 {"--integrator", integrator_names(), &o->integrator}};
  for (int k = 0; k < (int)(sizeof numbers / sizeof numbers[0]); k++) {
    if (strcmp(name, numbers[k].name) == 0) {
      return read_bounded(numbers[k].value, name, text, numbers[k].least, numbers[k].open);
    }
  }
  for (int k = 0; k < (int)(sizeof choices / sizeof choices[0]); k++) {
    if (strcmp(name, choices[k].name) == 0) {
      return read_choice(choices[k].value, name, text, choices[k].names);
    }
  }
  if (strcmp(name, "--modes") == 0) {
    return read_whole(&o->modes, name, text, 0, MAX_BENDING);
  } else if (strcmp(name, "--elements") == 0) {
    return read_whole(&o->elements, name, text, 1, FB_MAX_ELEMENTS);
  } else if (strcmp(name, "--polynomial") == 0) {
    return read_whole(&o->polynomial, name, text, 3, 8);
  } else if (strcmp(name, "--effects") == 0) {
    return read_effects(&o->effects, text);
  } else if (strcmp(name, "--out") == 0 || strcmp(name, "--reference") == 0) {
    *(name[2] == 'o' ? &o->out : &o->reference) = text;
    return text[0] ? 0 : fail("empty file name", name);
  }
  return -1;
}

/* What does not go together, and what to do. */
static int check_options(const options *o)
{
  const int elements = o->elements != NOT_GIVEN, torque = o->drive == DRIVE_TORQUE;
  const unsigned effects = o->effects == NOT_GIVEN ? FB_EFFECTS_FULL : (unsigned)o->effects;
  const unsigned quadratic = FB_EFFECT_SPIN_STIFFENING | FB_EFFECT_ACCELERATION_STIFFENING;
  const struct {
    int wrong;
    const char *what;
  } checks[] = {
      {elements && o->modes != NOT_GIVEN, "--elements stands instead of --modes: leave one of them out"},
      {elements && o->effects != NOT_GIVEN, "--effects goes with --modes; with --elements there is --degree"},
      {elements && o->scene.ea <= 0, "--elements wants --ea greater than 0"},
      {!elements && o->polynomial != NOT_GIVEN, "--polynomial wants --elements"},
      {!elements && o->basis != NOT_GIVEN, "--basis wants --elements"},
      {!elements && o->degree != NOT_GIVEN, "--degree wants --elements; with --modes there is --effects"},
      {o->form == FB_FORM_FIRST && !elements && (effects & quadratic) != 0,
       "--form first has no quadratic displacement: use --elements, or --effects linear or spin-coupling"},
      {o->torque_form != NOT_GIVEN && (o->form != FB_FORM_FIRST || !elements),
       "--torque-form wants --form first and --elements"},
      {o->torque_form != NOT_GIVEN && !torque,
       "--torque-form turns a hinged beam, a prescribed hub does not feel it: add --drive torque"},
      {o->integrator != NOT_GIVEN && o->integrator == FB_INTEGRATOR_EXPONENTIAL && o->form != NOT_GIVEN &&
           o->form != FB_FORM_MOMENTUM,
       "--integrator exponential is for --form momentum"},
      {!torque && !isnan(o->torque), "--torque wants --drive torque; the hub has --spin"},
      {!torque && o->after != NOT_GIVEN, "--after wants --drive torque"},
      {torque && !isnan(o->spin), "--spin wants --drive hub; the torque has --torque"},
      {strlen(o->out) > 400, "--out: the name is longer than 400 characters"},
      {strlen(o->out) > 4 && strcmp(o->out + strlen(o->out) - 4, ".svg") == 0,
       "--out names the CSV; the picture gets its name with .svg"},
  };
  for (int k = 0; k < (int)(sizeof checks / sizeof checks[0]); k++) {
    if (checks[k].wrong) {
      return fail(checks[k].what, "");
    }
  }
  return 0;
}

/* The scene as the options have it. */
static void take_options(options *o)
{
  scene *s = &o->scene;
  const struct {
    int given;
    int *value;
  } taken[] = {{o->modes, &s->modes},
               {o->elements, &s->elements},
               {o->polynomial, &s->polynomial},
               {o->basis, &s->basis},
               {o->degree, &s->degree},
               {o->planes == NOT_GIVEN ? NOT_GIVEN : o->planes + 1, &s->planes},
               {o->form, &s->form},
               {o->torque_form, &s->torque_form},
               {o->integrator, &s->integrator},
               {o->drive, &s->drive},
               {o->after, &s->after}};
  const int alone[] = {o->modes, o->effects, o->elements, o->planes, o->form, o->integrator, o->drive};
  for (int k = 0; k < (int)(sizeof taken / sizeof taken[0]); k++) {
    *taken[k].value = taken[k].given == NOT_GIVEN ? *taken[k].value : taken[k].given;
  }
  for (int k = 0; k < (int)(sizeof alone / sizeof alone[0]); k++) {
    o->alone |= alone[k] != NOT_GIVEN;
  }
  s->effects = o->effects == NOT_GIVEN ? s->effects : (unsigned)o->effects;
  s->spin = isnan(o->spin) ? s->spin : o->spin;
  s->torque = isnan(o->torque) ? s->torque : o->torque;
}

static int read_options(options *o, int argc, char **argv)
{
  int status;
  for (int i = 1; i < argc; i += 2) {
    if (strcmp(argv[i], "--help") == 0) {
      printf(help, integrator_names());
      exit(0);
    }
    if (i + 1 == argc) {
      return fail("no such option, or its value is missing", argv[i]);
    }
    status = read_option(o, argv[i], argv[i + 1]);
    if (status != 0) {
      return status > 0 ? status : fail("unknown option", argv[i]);
    }
  }
  status = check_options(o);
  if (status == 0) {
    take_options(o);
  }
  return status;
}

/* ---- output */

static int write_csv(const history *h, const char *path, int with_work)
{
  FILE *file = output_open(path);
  if (!file) {
    return fail("cannot write", path);
  }
  fprintf(file, "t,tip_x,tip_y,omega_z,energy%s\n", with_work ? ",work" : "");
  for (int k = 0; k < h->rows; k++) {
    fprintf(file, "%.10g,%.10g,%.10g,%.10g,%.10g", h->t[k], h->tip_x[k], h->tip_y[k], h->omega[k], h->energy[k]);
    if (with_work) {
      fprintf(file, ",%.10g", h->work[k]);
    }
    fputc('\n', file);
  }
  return output_close(file, path);
}

static void draw(const options *o, const char *full, const char *linear, const char *split)
{
  char svg[512], settings[256];
  const curve curves[] = {
      {full, "1:3", "every ::1 with lines lw 2 lc rgb '#0060ad'", "3 modes, all effects"},
      {linear, "1:3", "every ::1 with lines lw 2 lc rgb '#888888'", "3 modes, linear"},
      {split, "1:3", "every ::1 with lines lw 2 lc rgb '#dd181f'", "3 modes, softening without stiffening"},
      {o->reference, "(column(\"t\")):(column(\"GE_u2\"))", "with points pt 6 ps 0.6 lc rgb '#000000'",
       "geometrically exact reference"}};
  other_name(svg, sizeof svg, o->out, ".svg");
  snprintf(settings, sizeof settings,
           "set ylabel 'tip deflection [m]'\nset yrange [%g:%g]\n"
           "set title 'Spin-up of a flexible beam: what each effect does to the tip'\n",
           -0.1 * o->scene.length, 0.03 * o->scene.length);
  plot(svg, settings, curves, o->reference ? 4 : 3, stdout);
}

/* ---- the two ways to run */

static history result;
static series target;

/* The step where none was asked for, and a bound on their number. */
static int choose_step(options *o)
{
  scene *s = &o->scene;
  scene stiffest = *s;
  int status;
  stiffest.modes = o->alone ? s->modes : 6;
  stiffest.effects = s->elements || s->form == FB_FORM_FIRST ? s->effects : FB_EFFECTS_FULL;
  status = build_or_say(&stiffest);
  if (status != 0) {
    return status;
  }
  if (s->dt <= 0) {
    s->dt = default_step(s);
  }
  return s->t_end / s->dt > 1e8 ? fail("more than 1e8 steps: enlarge --dt or shorten --t-end", "") : 0;
}

static int simulate(const scene *s, int timed)
{
  const int status = build_or_say(s);
  if (status != 0) {
    return status;
  }
  if (s->dt > step_limit(s)) {
    char message[96], limit[64];
    snprintf(message, sizeof message, "--dt is longer than the stability limit of %s", integrators[s->integrator].name);
    snprintf(limit, sizeof limit, "%.4g s for %d %s", step_limit(s), model.formed.body.n,
             s->elements ? "coordinates" : "modes");
    return fail(message, limit);
  }
  run_timed(&result, s, timed ? 3 : 0);
  return 0;
}

static void print_row(const scene *s, const char *name, double error)
{
  char text[32];
  if (result.status == FB_OK) {
    snprintf(text, sizeof text, "%9.4f %%", 100 * error);
  } else {
    snprintf(text, sizeof text, "stops %5.2f s", result.t_stop);
  }
  printf("%5d  %-38s %13s %9.0f %12.0f  %s\n", s->modes, name, text, result.ns, real_time_factor(&result, s),
         result.status == FB_OK ? "" : fb_status_string(result.status));
}

/* What is half of something in the model just built. */
static void caution(const scene *s)
{
  const char *text = fb_status_string(FB_ERR_EFFECTS);
  if (s->elements && s->degree == 0) {
    text = "Q = 0 keeps the linear stiffness alone: the beam neither stiffens nor foreshortens";
  } else if (s->elements && s->degree == 1) {
    text = "Q = 1 splits the strain energy, what is left has no lower bound: the motion diverges";
  } else if (s->elements && s->form == FB_FORM_FIRST) {
    text = "Q = 2 cuts the stiffness torque of the first-order form, it no longer fits the elastic forces";
  } else if (s->elements) {
    text = "Q = 2 leaves nothing out: degree 3 is in the stiffness torque of --form first alone";
  }
  if (model.split) {
    printf("caution: %s\n", text);
  }
}

static void print_run(const options *o)
{
  const scene *s = &o->scene;
  double t;
  const double peak = tip_peak(&result, &t);
  if (s->elements) {
    printf("%d element(s) of degree %d, %s basis, %d coordinates: ", s->elements, s->polynomial,
           s->basis == BASIS_OPEN ? "open" : "closed", model.formed.body.n);
  } else {
    printf("%d mode(s): ", s->modes);
  }
  printf("%.0f ns per step, %.0f times real time; CSV: %s\n", result.ns, real_time_factor(&result, s), o->out);
  printf("%s, step %g s; largest tip deflection %.6f m at %.3f s\n", integrators[s->integrator].name,
         s->t_end / (double)steps_of(s), peak, t);
  if (o->reference) {
    printf("tip deflection: largest error %.4f %% of the reference's peak\n", 100 * tip_error(&result, &target));
  }
  if (s->drive == DRIVE_TORQUE) {
    printf("energy - work: at most %.2g of the peak energy\n", energy_error(&result));
  }
}

static int run_one(const options *o)
{
  const scene *s = &o->scene;
  int status = simulate(s, 1);
  if (status == 0) {
    caution(s);
    status = write_csv(&result, o->out, s->drive == DRIVE_TORQUE);
  }
  if (status != 0) {
    return status;
  }
  print_run(o);
  if (result.status == FB_OK) {
    return 0;
  }
  printf("stopped at t = %.3f s: %s\n", result.t_stop, fb_status_string(result.status));
  if (result.status == FB_ERR_STEP) {
    printf("the limit of %s is %.4g s undeflected at %.3g rad/s; slopes, stretch and faster rates lower it: try --dt "
           "%.3g\n",
           integrators[s->integrator].name, step_limit(s), final_spin(s), 0.5 * fmin(s->dt, step_limit(s)));
  } else if (result.status == FB_ERR_RANGE && !model.split) {
    printf("a shorter --dt or another --integrator shows whether it was the step or the model\n");
  }
  return 1;
}

typedef struct level {
  const char *name;
  unsigned effects;
  const char *ending; /* of the CSV that 3 modes write; NULL: none */
} level;

static const unsigned half_effect = FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA;

typedef struct outcome { /* of the table */
  char names[3][512];    /* CSV files: full, linear, split */
  double full3;          /* error of 3 modes with all effects */
  double large3;         /* and as a geometrically exact beam */
  int stopped;           /* the half effect was stopped by a status */
} outcome;

static int table_row(outcome *out, const options *o, scene *s, const level *l)
{
  int status = simulate(s, 1);
  if (status != 0) {
    return status;
  }
  print_row(s, s->modes ? l->name : "rigid", tip_error(&result, &target));
  if (s->modes == 3 && l->ending) {
    char *name = out->names[l->ending[0] == 0 ? 0 : s->effects == FB_EFFECTS_LINEAR ? 1 : 2];
    if (l->ending[0]) {
      other_name(name, sizeof out->names[0], o->out, l->ending);
    } else {
      snprintf(name, sizeof out->names[0], "%s", o->out);
    }
    status = write_csv(&result, name, 0);
  }
  if (s->modes == 3 && s->effects == FB_EFFECTS_FULL && result.status == FB_OK) {
    out->full3 = tip_error(&result, &target);
  }
  if (s->modes == 3 && s->effects == FB_EFFECTS_LARGE && result.status == FB_OK) {
    out->large3 = tip_error(&result, &target);
  }
  out->stopped += s->modes == 3 && s->effects == half_effect && result.status == FB_ERR_RANGE;
  return status;
}

static int table_rows(outcome *out, const options *o)
{
  static const int counts[] = {0, 1, 2, 3, 6};
  const level levels[] = {{"linear", FB_EFFECTS_LINEAR, "_linear.csv"},
                          {"+ spin coupling", FB_EFFECTS_SPIN, NULL},
                          {"+ residual inertia (half an effect)", half_effect, "_split.csv"},
                          {"+ spin stiffening", half_effect | FB_EFFECT_SPIN_STIFFENING, NULL},
                          {"+ acceleration stiffening = full", FB_EFFECTS_FULL, ""},
                          {"+ large deflection = large", FB_EFFECTS_LARGE, NULL}};
  scene s = o->scene;
  int status = 0;
  for (int c = 0; c < 5 && status == 0; c++) {
    for (int k = 0; k < (counts[c] == 0 ? 1 : (int)(sizeof levels / sizeof levels[0])) && status == 0; k++) {
      s.modes = counts[c];
      s.effects = levels[k].effects;
      status = table_row(out, o, &s, &levels[k]);
    }
  }
  return status;
}

static int run_table(const options *o)
{
  static outcome out = {.full3 = 1.0, .large3 = 1.0};
  scene s = o->scene;
  int status;
  s.modes = 6;
  status = simulate(&s, 0); /* the stiffest: its step limit before any output */
  if (status == 0) {
    status = write_csv(&result, o->out, 0); /* the file can be written */
  }
  if (status != 0) {
    return status;
  }
  if (!o->reference) {
    target.rows = result.rows;
    memcpy(target.t, result.t, sizeof target.t);
    memcpy(target.y, result.tip_y, sizeof target.y);
  }
  printf("Spin-up to %g rad/s in %g s, beam %g m, %g kg, EI %g N m^2; %s, step %g s\n", s.spin, s.ramp, s.length,
         s.mass, s.ei, integrators[s.integrator].name, s.t_end / (double)steps_of(&s));
  printf("Error of the tip deflection in percent of the peak, against %s\n\n",
         o->reference ? "the geometrically exact reference" : "6 modes with all effects");
  printf("modes  effects                                        error   ns/step  x real time\n");
  status = table_rows(&out, o);
  if (status != 0) {
    return status;
  }
  printf("\nfb_effects_check on the half effect: %s\n", fb_status_string(fb_effects_check(half_effect)));
  printf("CSV: %s, %s, %s\n", out.names[0], out.names[1], out.names[2]);
  draw(o, out.names[0], out.names[1], out.names[2]);
  if (!o->reference) {
    return 0;
  }
  printf(
      "check: 3 modes with all effects within 0.2 %%: %.4f %%, with large deflection within 0.1 %%: %.4f %%; the half "
      "effect stopped by a status: %s\n",
      100 * out.full3, 100 * out.large3, out.stopped ? "yes" : "no");
  return out.full3 < 0.002 && out.large3 < 0.001 && out.stopped ? 0 : 1;
}

int main(int argc, char **argv)
{
  options o = {.modes = NOT_GIVEN,
               .effects = NOT_GIVEN,
               .elements = NOT_GIVEN,
               .polynomial = NOT_GIVEN,
               .basis = NOT_GIVEN,
               .planes = NOT_GIVEN,
               .form = NOT_GIVEN,
               .torque_form = NOT_GIVEN,
               .degree = NOT_GIVEN,
               .integrator = NOT_GIVEN,
               .drive = NOT_GIVEN,
               .after = NOT_GIVEN,
               .spin = (double)NAN,
               .torque = (double)NAN,
               .out = "spinup.csv"};
  int status;
  output_begin(PROGRAM);
  o.scene = default_scene;
  status = read_options(&o, argc, argv);
  if (status == 0 && o.reference) {
    status = read_reference(&target, o.reference);
  }
  status = status ? status : choose_step(&o);
  if (status != 0) {
    return status;
  }
  return o.alone ? run_one(&o) : run_table(&o);
}
