/* hard - the suite of hard cases: each runs the library where it is hard, measures what must hold, and takes the same
   measure of a naive treatment, which must fail. Table on stdout, CSV on request, progress on stderr.
   Exit: 0 all hold and bite, 1 one does not, 2 bad options. */
#define _POSIX_C_SOURCE 200112L /* clock_gettime, isatty */
#define FLEXBEAM_IMPLEMENTATION
#include "hard.h"
#include "../../examples/common/clock.h"
#include <unistd.h>
#define PROGRAM "hard"
#include "../../examples/common/options.h"
#include "../../examples/common/output.h"

static const char help[] =
    "hard - the hard cases: what holds, by how much, and what a naive treatment gives\n"
    "usage: hard [options]\n"
    "  --case NAME   only this one\n"
    "  --brief       short runs: seconds instead of minutes, the same bounds\n"
    "  --out FILE    CSV of the rows\n"
    "  --list        names of the cases\n"
    "  --help        this text\n"
    "margin: bound / figure. Exit: 1 when a case does not hold, or the naive treatment holds as well.\n";

typedef struct hard_case {
  const char *name;
  void (*run)(int brief);
} hard_case;

static const hard_case cases[] = {
    {"flat-spin", hard_flat_spin}, {"fast-spin", hard_fast_spin},   {"axial", hard_axial},
    {"long", hard_long},           {"resonance", hard_resonance},   {"rounding", hard_rounding},
    {"decay", hard_decay},         {"latches", hard_latches},       {"massless", hard_massless},
    {"loop", hard_loop},           {"column", hard_column},         {"circle", hard_circle},
    {"growth", hard_growth},       {"kicked", hard_kicked},         {"thrown", hard_thrown},
    {"helix", hard_helix},         {"long-steps", hard_long_steps}, {"many-modes", hard_many_modes},
    {"units", hard_units},         {"absurd", hard_absurd},         {"rotor", hard_rotor},
    {"flight", hard_flight},       {"slender", hard_slender},       {"roll", hard_roll},
    {"release", hard_release},     {"long-bent", hard_long_bent},
};

typedef struct options {
  const char *name, *out;
  int brief;
} options;

static const hard_case *running;
static FILE *csv;
static int rows, failures, told;
static double began, said; /* [ns] */

void hard_must(fb_status status, const char *what)
{
  if (status != FB_OK) {
    fprintf(stderr, "hard: %s: %s: %s\n", running->name, what, fb_status_string(status));
    exit(1);
  }
}

void hard_progress(double done, double whole)
{
  const double now = told++ % 1024 == 0 ? clock_ns() : said;
  if (now > said + 5e8 && isatty(2)) {
    fprintf(stderr, "\r%-12s %3.0f %%, %.0f s ", running->name, 100.0 * done / whole, 1e-9 * (now - began));
    said = now;
  }
}

/* ---- rows */

static int within(double figure, double bound)
{
  return figure <= bound; /* not a number: no */
}

/* A figure, or that there is none. */
static const char *text_of(char *text, size_t size, double figure)
{
  if (figure < (double)FB_HUGE) {
    snprintf(text, size, "%.1e", figure);
  } else {
    snprintf(text, size, "diverges");
  }
  return text;
}

static void csv_row(const hard_row *r, double margin, const char *verdict)
{
  fprintf(csv, "%s,\"%s\",\"%s\",\"%s\",%.6g,%.0f,%.6g,%.6g,\"%s\",%.3e,%.1e,%.3g,\"%s\",%.3e,%s\n",
          FB_SINGLE ? "single" : "double", r->name, r->what, r->degree, r->hard, r->steps, r->time, r->periods,
          r->measure, r->figure, r->bound, margin, r->naive, r->naive_figure, verdict);
}

void hard_report(const hard_row *r)
{
  const int holds = within(r->figure, r->bound), bites = !within(r->naive_figure, r->bound);
  const double margin = r->bound / r->figure;
  const char *verdict = !holds ? "FAIL" : bites ? "ok" : r->excused ? "excused" : "NAIVE HOLDS";
  char figure[32], naive[32];
  printf("%-22s %s\n  hard   %s %.3g", r->name, r->what, r->degree, r->hard);
  if (r->steps > 0.0) {
    printf("; %.3g steps", r->steps);
  }
  if (r->time > 0.0) {
    printf(", %.3g s", r->time);
  }
  if (r->periods > 0.0) {
    printf(", %.3g periods", r->periods);
  }
  printf("\n  %-6s %s: %s, bound %.1e, margin %.2g\n", verdict, r->measure, text_of(figure, sizeof figure, r->figure),
         r->bound, margin);
  printf("  naive  %s: %s\n", r->naive, text_of(naive, sizeof naive, r->naive_figure));
  fflush(stdout);
  if (csv) {
    csv_row(r, margin, verdict);
  }
  rows++;
  failures += !holds || !(bites || r->excused);
}

/* ---- shared */

void hard_craft_init(hard_craft *craft, double length, double mass_per_length, double EI)
{
  memset(craft, 0, sizeof *craft);
  craft->beam.length = (fb_real)length;
  craft->beam.n_element = 10;
  craft->beam.n_station = 1;
  craft->beam.station[0].mass = (fb_real)mass_per_length;
  craft->beam.station[0].EI_y = craft->beam.station[0].EI_z = (fb_real)EI;
  craft->level.effects = FB_EFFECTS_FULL;
}

void hard_craft_stretch(hard_craft *craft, double EA, int degree)
{
  craft->beam.station[0].EA = (fb_real)EA;
  craft->beam.n_element = 3;
  craft->keep.basis = FB_BASIS_FUNCTIONS;
  craft->keep.degree = degree;
  craft->keep.count[FB_KIND_BEND_Y] = craft->keep.count[FB_KIND_AXIAL] = FB_ALL_MODES;
  craft->keep.root_strain = 1;
  craft->strain = 1;
  craft->level.effects = FB_EFFECTS_STRAIN;
  craft->level.base = FB_BASE_PRESCRIBED;
}

fb_shape hard_shape;

void hard_craft_build(fb_body *body, const hard_craft *craft)
{
  static const fb_real center[3] = {0};
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_body_work body_work;
  int node;
  hard_must(fb_beam_init(&beam, &craft->beam), "beam");
  hard_must(fb_modes_solve(&modes, &modes_work, &beam, &craft->keep), "modes");
  hard_must(fb_shape_init(&hard_shape, modes.n), "shape");
  if (craft->hub_mass > 0.0) {
    fb_real inertia[6] = {0};
    for (int i = 0; i < 3; i++) {
      inertia[i] = (fb_real)craft->hub_inertia[i];
    }
    hard_must(fb_shape_add_rigid(&hard_shape, (fb_real)craft->hub_mass, center, inertia), "hub");
  }
  hard_must(fb_shape_add_beam(&hard_shape, 0, &beam, &modes), "shape of the beam");
  if (craft->strain) {
    hard_must(fb_shape_add_beam_strain(&hard_shape, 0, &beam, &modes), "strain stations");
  }
  hard_must(fb_shape_add_beam_node(&hard_shape, &node, 0, &beam, &modes, beam.desc.length), "tip");
  hard_must(fb_body_init(body, &body_work, &hard_shape, &craft->level), "body");
}

void hard_start(const fb_body *body, fb_state *state, const double v[3], const double w[3], const fb_real *q_dot)
{
  const fb_real speed[3] = {(fb_real)v[0], (fb_real)v[1], (fb_real)v[2]};
  const fb_real rate[3] = {(fb_real)w[0], (fb_real)w[1], (fb_real)w[2]};
  hard_must(fb_state_init(body, state), "state");
  hard_must(fb_state_from_velocity(body, state, speed, rate, q_dot), "state");
}

double hard_energy(const fb_body *body, const fb_state *state)
{
  fb_energy energy;
  return fb_body_energy_eval(body, &energy, state, NULL) == FB_OK ? (double)energy.kinetic + (double)energy.strain
                                                                  : HUGE_VAL;
}

void hard_tip(double u[3], const fb_body *body, const fb_state *state)
{
  static fb_motion rest; /* positions want no velocities */
  fb_node_motion tip;
  const fb_status status = fb_body_node_motion_eval(body, &tip, state, &rest, HARD_TIP);
  for (int i = 0; i < 3; i++) {
    u[i] = status == FB_OK ? (double)tip.displacement[i] : HUGE_VAL;
  }
}

double hard_difference(const fb_real *a, const fb_real *b, int n)
{
  double most = 0.0;
  for (int i = 0; i < n; i++) {
    most = fmax(most, fabs((double)a[i] - (double)b[i]));
  }
  return most;
}

double hard_length(const fb_real *x)
{
  return sqrt((double)x[0] * (double)x[0] + (double)x[1] * (double)x[1] + (double)x[2] * (double)x[2]);
}

static void add_scaled(fb_real *y, double a, const fb_real *x, int n)
{
  for (int i = 0; i < n; i++) {
    y[i] += (fb_real)(a * (double)x[i]);
  }
}

void hard_advance(fb_state *state, double dt, const fb_state *rate, int n)
{
  add_scaled(state->rho, dt, rate->rho, 3);
  add_scaled(state->quat, dt, rate->quat, 4);
  add_scaled(state->u, dt, rate->u, 3);
  add_scaled(state->L, dt, rate->L, 3);
  add_scaled(state->q, dt, rate->q, n);
  add_scaled(state->pi, dt, rate->pi, n);
}

int hard_euler(const fb_body *body, fb_state *state, const fb_input *input, double dt)
{
  fb_state rate;
  if (fb_body_rates_eval(body, &rate, state, input) != FB_OK) {
    return 0;
  }
  hard_advance(state, dt, &rate, body->n);
  return 1;
}

int hard_rk4(const fb_body *body, fb_state *state, double dt)
{
  static const double part[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
  const fb_state from = *state;
  fb_state rate = from; /* of which the first stage takes nothing */
  for (int stage = 0; stage < 4; stage++) {
    fb_state at = from;
    hard_advance(&at, part[stage] * dt, &rate, body->n);
    if (fb_body_rates_eval(body, &rate, &at, NULL) != FB_OK) {
      return 0;
    }
    hard_advance(state, weight[stage] * dt, &rate, body->n);
  }
  return 1;
}

/* ---- program */

static int read_option(void *target, const char *name, const char *text)
{
  options *const o = target;
  if (strcmp(name, "--case") == 0) {
    int known = 0;
    o->name = text;
    for (int k = 0; k < HARD_COUNT(cases); k++) {
      known += strcmp(cases[k].name, text) == 0;
    }
    return known ? 0 : fail("no such case, --list has them", text);
  }
  return strcmp(name, "--out") == 0 ? read_out(&o->out, text) : NO_SUCH_OPTION;
}

static void run(const hard_case *c, int brief)
{
  running = c;
  began = said = clock_ns();
  fprintf(stderr, "%s%s ...%s", isatty(2) ? "\r" : "", c->name, isatty(2) ? "" : "\n");
  c->run(brief);
  fprintf(stderr, "%s%-12s %.1f s                    \n", isatty(2) ? "\r" : "", c->name, 1e-9 * (clock_ns() - began));
}

int main(int argc, char **argv)
{
  options o = {NULL, NULL, 0};
  int status;
  output_begin(PROGRAM);
  o.brief = take_flag(&argc, argv, "--brief");
  if (take_flag(&argc, argv, "--list")) {
    for (int k = 0; k < HARD_COUNT(cases); k++) {
      puts(cases[k].name);
    }
    return 0;
  }
  status = read_all(argc, argv, help, read_option, &o);
  if (status != 0) {
    return status;
  }
  if (o.out) {
    csv = fopen(o.out, "w");
    if (!csv) {
      return fail(strerror(errno), o.out);
    }
    fputs(
        "precision,case,what,degree,hard,steps,time_s,periods,measure,figure,bound,margin,naive,naive_figure,verdict\n",
        csv);
  }
  for (int k = 0; k < HARD_COUNT(cases); k++) {
    if (!o.name || strcmp(cases[k].name, o.name) == 0) {
      run(&cases[k], o.brief);
    }
  }
  if (csv && output_close(csv, o.out)) {
    return 2;
  }
  printf("%d rows in %s precision, %d failed\n", rows, FB_SINGLE ? "single" : "double", failures);
  return failures > 0;
}
