/* table1 - [DB] section 4 again: table 1 (run times of the forms), figures 2 to 5, and what accuracy costs in time.
   The tables go to standard output, the figures as CSV and, where gnuplot is installed, SVG to a directory.
   Exit: 0 well, 1 a check failed, 2 bad options. */
#define _POSIX_C_SOURCE 200809L /* popen, for gnuplot */
#define PROGRAM "table1"
#include "spinup_model.h"
#include "../common/plot.h"
#include "../common/output.h"

#define GRID 3001      /* values on a grid of 0.01 s */
#define GRID_STEP 0.01 /* [s] */

typedef struct options {
  const char *out, *reference; /* directories */
  int repeat;
} options;

static const char help[] =
    "table1 - run times of three forms of the equations of motion, figures, accuracy: [DB] section 4\n"
    "usage: table1 [options] > tables.txt\n"
    "  --out DIR        existing directory for figure2..5.csv and .svg (.)\n"
    "  --reference DIR  where p07A_second_order.csv, p07C_second_order.csv, p07_peaks.csv, p07_Q.csv are\n"
    "                   (tests/reference)\n"
    "  --repeat N       timed runs, 1..20, the quietest counts (3)\n"
    "  --help           this text\n"
    "[DB] D'Eleuterio and Barfoot, Just a second, we'd like to go first.\n";

static history result;
static int failures;

static void check(int ok, const char *what)
{
  if (!ok) {
    fprintf(stderr, "table1: check failed: %s\n", what);
    failures++;
  }
}

/* The row of an integrator. */
static int integrator_of(const char *name)
{
  int k = 0;
  while (k + 1 < INTEGRATORS && strcmp(integrators[k].name, name) != 0) {
    k++;
  }
  return k;
}

/* ---- table 1 */

enum { FORMS = 3 };
static const int forms[FORMS] = {FB_FORM_SECOND, FB_FORM_FIRST, FB_FORM_MOMENTUM};

typedef struct form_times {
  double seconds[FORMS]; /* for the whole motion */
  double difference;     /* of the first-order form's tip from the second's, of its peak */
  double leak;           /* largest of energy - work, of the peak energy */
  fb_status status;      /* the first that is not FB_OK */
} form_times;

static void sample(double *out, const double *column)
{
  for (int k = 0; k < GRID; k++) {
    out[k] = result.status == FB_OK ? value_at(&result, column, GRID_STEP * k) : (double)NAN;
  }
}

static double largest(const double *x, const double *y)
{
  double most = 0;
  for (int k = 0; k < GRID; k++) {
    most = fmax(most, fabs(x[k] - (y ? y[k] : 0)));
  }
  return most;
}

/* All forms of one scene, recorded once, then timed in turns. */
static int time_forms(form_times *out, const scene *first_scene, int repeat)
{
  static double tip[FORMS][GRID];
  scene s = *first_scene;
  memset(out, 0, sizeof *out);
  for (int r = 0; r <= repeat; r++) {
    for (int f = 0; f < FORMS; f++) {
      int status;
      s.form = forms[f];
      status = build_or_say(&s);
      if (status != 0) {
        return status;
      }
      run(&result, &s, r == 0 ? stride_of(&s) : 0);
      out->status = out->status ? out->status : result.status;
      if (r == 0) {
        sample(tip[f], result.tip_y);
        out->leak = fmax(out->leak, energy_error(&result));
      } else {
        const double seconds = 1e-9 * result.ns * (double)steps_of(&s);
        out->seconds[f] = r == 1 ? seconds : fmin(seconds, out->seconds[f]);
      }
    }
  }
  out->difference = largest(tip[1], tip[0]) / largest(tip[0], NULL);
  return 0;
}

static double saving(const form_times *t, int form)
{
  return 100 * (1 - t->seconds[form] / t->seconds[0]);
}

static int print_times(const scene *s, int repeat)
{
  static const double paper[] = {20.5, 10.6, 34.2}; /* [%] [DB] table 1 */
  form_times t;
  const int status = time_forms(&t, s, repeat);
  if (status != 0) {
    return status;
  }
  printf("%-10s %3d %3d %6.3f %8.3f %7.3f %9.3f %9.1f %6.1f %13.1f %13.1e %13.1e\n", integrators[s->integrator].name,
         s->elements, model.formed.body.n, 1e3 * s->dt, t.seconds[0], t.seconds[1], t.seconds[2], saving(&t, 1),
         paper[s->elements - 1], saving(&t, 2), t.difference, t.leak);
  fflush(stdout);
  check(t.status == FB_OK, "every form runs to the end");
  if (s->integrator == integrator_of("rk4")) {
    check(t.difference < 1e-5, "rk4: the first- and the second-order form agree to 1 part in 1e5");
    check(t.leak < 1e-3, "rk4: energy and work agree to 1e-3 of the peak energy");
    check(t.seconds[1] < t.seconds[0], "rk4: the first-order form is faster than the second-order form");
  }
  return 0;
}

static int table1(const options *o)
{
  scene s = default_scene;
  int status = 0;
  s.drive = DRIVE_TORQUE;
  s.basis = BASIS_CLOSED;
  s.planes = 2;
  printf("Table 1: seconds of computation for %g s of motion by a torque, by the form of the equations of motion. N_e "
         "closed\n"
         "cubic elements, n coordinates, bending in both planes, steps in ms. What the first-order and the momentum "
         "form save\n"
         "against the second-order form, in percent, beside the first-order form in the paper; the largest difference "
         "of the\n"
         "first- from the second-order tip deflection and of energy from work, relative to the peaks\n\n"
         "integrator     N_e   n   step   second   first  momentum  first -%%  paper    momentum -%%  first-second   "
         "energy-work\n",
         s.t_end);
  for (s.integrator = 0; s.integrator < integrator_of("exponential") && status == 0;
       s.integrator++) { /* that one has one form */
    for (s.elements = 1; s.elements <= 3 && status == 0; s.elements++) {
      fprintf(stderr, "table 1: %s, N_e = %d\n", integrators[s.integrator].name, s.elements);
      status = build_or_say(&s);
      s.dt = fmin(0.00025, default_step(&s)); /* the stiffness torque of the first-order form is explicit */
      status = status ? status : print_times(&s, o->repeat);
    }
  }
  return status;
}

/* ---- figures 2 to 5 */

enum { RUNS = 5 };

typedef struct curves_of_run {
  const char *name;
  int elements, degree;
  const char *peak; /* line of p07_Q.csv up to its peak */
} curves_of_run;

static const curves_of_run runs[RUNS] = {{"N_e = 1", 1, 3, "A,C1,first,3,ok,,"},
                                         {"N_e = 2", 2, 3, "A,C2,first,3,ok,,"},
                                         {"N_e = 3 (Q = 3)", 3, 3, "A,C3,first,3,ok,,"},
                                         {"N_e = 3 (Q = 0)", 3, 0, "A,C3,first,0,ok,,"},
                                         {"N_e = 3 (Q = 2)", 3, 2, "A,C3,first,2,ok,,"}};
static double tip[2][RUNS][GRID]; /* axial and transverse */

typedef struct figure {
  const char *name, *title;
  int direction; /* 0 axial, 1 transverse */
  int run[3];
} figure;

/* The number after a beginning of a line. */
static int read_value(double *x, const options *o, const char *file, const char *begin)
{
  static char path[512], line[16384];
  FILE *in;
  int found = 0;
  snprintf(path, sizeof path, "%s/%s", o->reference, file);
  in = fopen(path, "r");
  while (in && !found && fgets(line, sizeof line, in)) {
    found = strncmp(line, begin, strlen(begin)) == 0;
  }
  if (in) {
    fclose(in);
  }
  *x = found ? strtod(line + strlen(begin), NULL) : 0;
  return found ? 0 : fail("no such reference value", path);
}

static int write_figure(const options *o, const figure *f)
{
  char csv[512], svg[512], reference[512], settings[256];
  curve curves[4];
  static const char *const style[] = {"every ::1 with lines lw 2 lc rgb '#888888'",
                                      "every ::1 with lines lw 2 lc rgb '#dd181f'",
                                      "every ::1 with lines lw 2 lc rgb '#0060ad'"};
  FILE *file;
  snprintf(csv, sizeof csv, "%s/%s.csv", o->out, f->name);
  snprintf(svg, sizeof svg, "%s/%s.svg", o->out, f->name);
  snprintf(reference, sizeof reference, "%s/p07A_second_order.csv", o->reference);
  snprintf(settings, sizeof settings, "set ylabel 'tip deflection [m]'\nset title '%s'\n", f->title);
  file = output_open(csv);
  if (!file) {
    return fail("cannot write", csv);
  }
  fprintf(file, "t,%s,%s,%s\n", runs[f->run[0]].name, runs[f->run[1]].name, runs[f->run[2]].name);
  for (int k = 0; k < GRID; k++) {
    const double(*u)[GRID] = (const double(*)[GRID])tip[f->direction];
    fprintf(file, "%.10g,%.10g,%.10g,%.10g\n", GRID_STEP * k, u[f->run[0]][k], u[f->run[1]][k], u[f->run[2]][k]);
  }
  if (output_close(file, csv)) {
    return 2;
  }
  printf("CSV: %s\n", csv);
  for (int k = 0; k < 3; k++) {
    static const char *const using[] = {"1:2", "1:3", "1:4"};
    curves[k] = (curve){csv, using[k], style[k], runs[f->run[k]].name};
  }
  curves[3] =
      (curve){reference, f->direction ? "(column(\"t\")):(column(\"GE_u2\"))" : "(column(\"t\")):(column(\"GE_u1\"))",
              "with points pt 6 ps 0.6 lc rgb '#000000'", "geometrically exact reference"};
  plot(svg, settings, curves, 4, stdout);
  return 0;
}

static int figures(const options *o)
{
  static const figure all[] = {{"figure2", "Transverse deflection (full model, Q = 3)", 1, {0, 1, 2}},
                               {"figure3", "Axial deflection (full model, Q = 3)", 0, {0, 1, 2}},
                               {"figure4", "Effect of higher-degree terms on transverse deflection", 1, {3, 4, 2}},
                               {"figure5", "Effect of higher-degree terms on axial deflection", 0, {3, 4, 2}}};
  int status = 0;
  printf("Figures 2 to 5: first-order form, closed cubic elements, torque; peaks against independent ones\n\n"
         "model               peak [m]  reference [m]\n");
  for (int k = 0; k < RUNS && status == 0; k++) {
    scene s = default_scene;
    double peak, reference, t;
    s.drive = DRIVE_TORQUE;
    s.basis = BASIS_CLOSED;
    s.form = FB_FORM_FIRST;
    s.elements = runs[k].elements;
    s.degree = runs[k].degree;
    fprintf(stderr, "figures: %s\n", runs[k].name);
    status = build_or_say(&s);
    status = status ? status : read_value(&reference, o, "p07_Q.csv", runs[k].peak);
    if (status != 0) {
      return status;
    }
    s.dt = default_step(&s);
    run(&result, &s, stride_of(&s));
    peak = tip_peak(&result, &t);
    printf("%-15s %12.8f  %13.8f\n", runs[k].name, peak, reference);
    check(result.status == FB_OK && fabs(peak / reference - 1) < 1e-5, "peaks of the figures to 1e-5");
    sample(tip[0][k], result.tip_x);
    sample(tip[1][k], result.tip_y);
  }
  printf("\n");
  for (int k = 0; k < 4 && status == 0; k++) {
    status = write_figure(o, &all[k]);
  }
  printf("\n");
  return status;
}

/* ---- accuracy and its cost */

typedef struct accuracy_row {
  const char *name;
  int elements, polynomial, integrator;
  const char *same; /* model of p07_peaks.csv that has this peak; NULL: none */
  double tolerance; /* of it */
  double dt;        /* [s]; 0: the integrator's default */
} accuracy_row;

static int print_accuracy(const options *o, scene *s, const accuracy_row *row, const series *target, double exact)
{
  double peak, t, same = 0;
  char begin[32];
  int status;
  fprintf(stderr, "accuracy: %s, %s\n", s->drive == DRIVE_HUB ? "hub" : "torque", row->name);
  s->elements = row->elements;
  s->polynomial = row->polynomial;
  s->integrator = row->integrator;
  status = build_or_say(s);
  if (status == 0 && row->same) {
    snprintf(begin, sizeof begin, "%c,%s,", s->drive == DRIVE_HUB ? 'C' : 'A', row->same);
    status = read_value(&same, o, "p07_peaks.csv", begin);
  }
  if (status != 0) {
    return status;
  }
  if (row->dt > step_limit(s)) {
    return 0; /* not for this drive */
  }
  s->dt = row->dt > 0 ? row->dt : default_step(s);
  run_timed(&result, s, o->repeat);
  peak = tip_peak(&result, &t);
  printf("%-6s  %-33s %3d  %-11s %7.3f %8.3f %12.0f %7.3f %8.3f\n", s->drive == DRIVE_HUB ? "hub" : "torque", row->name,
         model.formed.body.n, integrators[s->integrator].name, 1e3 * s->dt, 1e-3 * result.ns,
         real_time_factor(&result, s), 100 * (peak / exact - 1), 100 * tip_error(&result, target));
  fflush(stdout);
  check(result.status == FB_OK, "every model runs to the end");
  check(row->same == NULL || fabs(peak / same - 1) < row->tolerance, "the peak of the same model by other means");
  check(row->elements > 0 || fabs(peak / exact - 1) < 0.002, "three modes: the peak to 0.2 %");
  return 0;
}

static int accuracy(const options *o)
{
  static series target;
  const accuracy_row rows[] = {
      {"3 modes, quadratic displacement", 0, 3, integrator_of("rk4"), NULL, 0, 0},
      {"3 modes, quadratic displacement", 0, 3, integrator_of("exponential"), NULL, 0, 0.01},
      {"1 element, axial strain", 1, 3, integrator_of("rk4"), "H1", 1e-5, 0},
      {"2 elements, axial strain", 2, 3, integrator_of("rk4"), "H2", 1e-5, 0},
      {"3 elements, axial strain", 3, 3, integrator_of("rk4"), "H3", 1e-5, 0},
      {"3 elements, axial strain", 3, 3, integrator_of("midpoint"), "H3", 1e-3, 0},
      {"3 elements, axial strain", 3, 3, integrator_of("sdirk"), "H3", 5e-3, 0.005},
      {"3 elements, axial strain", 3, 3, integrator_of("exponential"), "H3", 1e-3, 0},
      {"3 elements, axial strain", 3, 3, integrator_of("exponential"), "H3", 1e-3, 0.01},
      {"1 element of degree 8 (converged)", 1, 8, integrator_of("rk4"), "LC", 1e-4, 0},
      {"1 element of degree 8 (converged)", 1, 8, integrator_of("exponential"), "LC", 1e-3, 0.01}};
  int status = 0;
  printf("Accuracy: errors of the tip deflection in percent of its peak, against the geometrically exact beam: of the "
         "peak,\n"
         "and the largest; momentum form, open basis, n coordinates, steps in ms, time of a step in us\n\n"
         "drive   model                               n  integrator     step  us/step  x real time   peak   largest\n");
  for (int drive_by = DRIVE_HUB; drive_by <= DRIVE_TORQUE && status == 0; drive_by++) {
    char path[512];
    double exact = 0;
    scene s = default_scene;
    s.drive = drive_by;
    snprintf(path, sizeof path, "%s/p07%c_second_order.csv", o->reference, drive_by == DRIVE_HUB ? 'C' : 'A');
    status = read_reference(&target, path);
    status = status ? status : read_value(&exact, o, "p07_peaks.csv", drive_by == DRIVE_HUB ? "C,GE," : "A,GE,");
    for (int k = 0; k < (int)(sizeof rows / sizeof rows[0]) && status == 0; k++) {
      status = print_accuracy(o, &s, &rows[k], &target, exact);
    }
  }
  return status;
}

int main(int argc, char **argv)
{
  options o = {".", "tests/reference", 3};
  int status = 0;
  output_begin(PROGRAM);
  for (int i = 1; i < argc && status == 0; i += 2) {
    if (strcmp(argv[i], "--help") == 0) {
      fputs(help, stdout);
      return 0;
    }
    if (i + 1 == argc) {
      return fail("no such option, or its value is missing", argv[i]);
    }
    if (strcmp(argv[i], "--repeat") == 0) {
      status = read_whole(&o.repeat, argv[i], argv[i + 1], 1, 20);
    } else if (strcmp(argv[i], "--out") == 0 || strcmp(argv[i], "--reference") == 0) {
      *(argv[i][2] == 'o' ? &o.out : &o.reference) = argv[i + 1];
      status = argv[i + 1][0] && strlen(argv[i + 1]) < 400 ? 0 : fail("empty or long directory name", argv[i]);
    } else {
      return fail("unknown option", argv[i]);
    }
  }
  status = status ? status : figures(&o); /* the quick part first: files that are missing are known at once */
  status = status ? status : accuracy(&o);
  printf("\n");
  status = status ? status : table1(&o);
  return status ? status : failures > 0;
}
