/* bench_accuracy.c - what accuracy costs in time: eight scenes by modal bodies of every set of effects, number of modes,
   scheme and step, and by the geometrically exact beam. The error is the largest over the run of the output (case.h)
   against the exact beam converged in mesh and step, of its largest value; the cost is nanoseconds of stepping per
   simulated second; both of the same run. Writes a CSV to the folder of its argument, tables to standard output. */
#define _POSIX_C_SOURCE 200112L
#define FB_MAX_MIXED 64
#define FB_MAX_MODES 20
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"

#include "case.h"
#include "report.h"

#define FBB_MAX_ENTRIES 6000

/* Rungs of the ladder: what a picture shows as one curve. */
enum { FBB_RIGID = 0, FBB_LINEAR = 1, FBB_SOME = 2, FBB_FULL = 3, FBB_STRAIN = 4, FBB_EXACT = 5, FBB_RUNGS = 6 };
static const char *const fbb_rung_name[] = {"rigid", "linear", "some", "full", "strain", "exact"};

typedef struct fbb_entry {
  const char *level, *scheme;
  int rung, effects; /* of the exact beam: no mask */
  fbb_basis basis;
  double dt, error, ns_per_s;
} fbb_entry;

typedef struct fbb_level {
  const char *name;
  int rung;
  unsigned effects;
} fbb_level;

/* C spin coupling, R residual inertia, S spin stiffening, A acceleration stiffening. */
static const fbb_level fbb_levels[] = {
    {"rigid", FBB_RIGID, FB_EFFECTS_RIGID},
    {"linear", FBB_LINEAR, FB_EFFECTS_LINEAR},
    {"C", FBB_SOME, FB_EFFECTS_SPIN},
    {"S", FBB_SOME, FB_EFFECTS_LINEAR | FB_EFFECT_SPIN_STIFFENING},
    {"A", FBB_SOME, FB_EFFECTS_LINEAR | FB_EFFECT_ACCELERATION_STIFFENING},
    {"CS", FBB_SOME, FB_EFFECTS_SPIN | FB_EFFECT_SPIN_STIFFENING},
    {"CA", FBB_SOME, FB_EFFECTS_SPIN | FB_EFFECT_ACCELERATION_STIFFENING},
    {"SA", FBB_SOME, FB_EFFECTS_LINEAR | FB_EFFECT_SPIN_STIFFENING | FB_EFFECT_ACCELERATION_STIFFENING},
    {"CSA", FBB_SOME, FB_EFFECTS_SPIN | FB_EFFECT_SPIN_STIFFENING | FB_EFFECT_ACCELERATION_STIFFENING},
    {"CRS", FBB_SOME, FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA | FB_EFFECT_SPIN_STIFFENING},
    {"full", FBB_FULL, FB_EFFECTS_FULL},
};

static fbb_entry entry[FBB_MAX_ENTRIES];
static int n_entry;
static fbb_history reference;

static void record(const fbb_entry *e, const fbb_history *h)
{
  if (n_entry == FBB_MAX_ENTRIES) {
    fprintf(stderr, "more than %d runs of a scene\n", FBB_MAX_ENTRIES);
    exit(1);
  }
  entry[n_entry] = *e;
  entry[n_entry].error = h->status == FB_OK ? fbb_difference(h, &reference) : HUGE_VAL;
  entry[n_entry].ns_per_s = h->ns_per_s;
  n_entry++;
}

/* ---- reference */

/* The exact beam's solution that meshes and steps lead to, both halved: of order 2 in both. */
static void extrapolate(fbb_history *out, const fbb_history *coarse, const fbb_history *fine)
{
  *out = *fine;
  for (int k = 0; k < FBB_SAMPLES; k++) {
    for (int i = 0; i < 3; i++) {
      out->out[k][i] += (fine->out[k][i] - coarse->out[k][i]) / 3;
    }
  }
}

/* Sets the reference and records the three solutions it is made of; returns how far it is estimated to be off. */
static double make_reference(const fbb_case *c)
{
  static fbb_history run[3], rough;
  fbb_entry e = {"exact", "mixed", FBB_EXACT, 0, {0, 0, 0}, 0, 0, 0};
  for (int k = 0; k < 3; k++) {
    fbb_exact_run(&run[k], c, 16 << k, 8 << k);
    fbb_check(run[k].status, c->name);
  }
  extrapolate(&rough, &run[0], &run[1]);
  extrapolate(&reference, &run[1], &run[2]);
  for (int k = 0; k < 3; k++) {
    e.basis.elements = 16 << k;
    e.dt = c->duration / FBB_SAMPLES / (8 << k);
    record(&e, &run[k]);
  }
  return fbb_difference(&rough, &reference) / 4;
}

static void run_exact(const fbb_case *c)
{
  static fbb_history h;
  fbb_entry e = {"exact", "mixed", FBB_EXACT, 0, {0, 0, 0}, 0, 0, 0};
  for (int n = 4; n <= 16; n *= 2) {
    for (int steps = 1; steps <= 4; steps *= 2) {
      fbb_exact_run(&h, c, n, steps);
      e.basis.elements = n;
      e.dt = c->duration / FBB_SAMPLES / steps;
      record(&e, &h);
    }
  }
}

/* ---- modal bodies */

/* The largest spin [rad/s] of a scene, for the limit of the step. */
static double largest_spin(const fbb_case *c)
{
  const double *w = c->spin;
  const double driven = c->drive == fbb_drive_spinup  ? c->size
                        : c->drive == fbb_drive_joint ? 2 * c->size / c->period
                                                      : 0;
  return sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]) + driven;
}

static void run_steps(const fbb_case *c, const fb_body *body, fbb_entry *e)
{
  static fbb_history h;
  const double sample = c->duration / FBB_SAMPLES, limit = (double)fb_rk4_limit(body, (fb_real)largest_spin(c), 0);
  const int fewest = limit < sample ? (int)ceil(sample / limit) : 1;
  for (int scheme = 0; scheme < FBB_SCHEMES; scheme++) {
    for (int k = 0, steps = scheme == FBB_RK4 ? fewest : 1; k < 4 && steps <= 4 * fewest; k++, steps *= 2) {
      if (scheme == FBB_RK4 && e->basis.elements && k > 0) {
        break; /* its steps are short enough */
      }
      fbb_body_run(&h, c, body, (fbb_scheme)scheme, steps);
      e->scheme = fbb_scheme_name[scheme];
      e->dt = sample / steps;
      record(e, &h);
    }
  }
}

static void run_body(const fbb_case *c, const fbb_level *level, const fbb_basis *basis)
{
  static fb_shape shape;
  static fb_body body;
  static fb_body_work work;
  fb_body_desc desc;
  fb_status status;
  fbb_entry e = {level->name, "", level->rung, (int)level->effects, *basis, 0, 0, 0};
  fbb_shape_make(&shape, c, basis);
  fbb_body_desc_make(&desc, c, level->effects | (fbb_has_gravity(c) ? (unsigned)FB_EFFECT_GRAVITY : 0u));
  status = fb_body_init(&body, &work, &shape, &desc);
  if (status != FB_ERR_EFFECTS) { /* half of something */
    fbb_check(status, c->name);
    run_steps(c, &body, &e);
  }
}

static void run_modal(const fbb_case *c)
{
  static const int count[] = {1, 2, 3, 4, 6};
  for (int level = 0; level < FBB_COUNT(fbb_levels); level++) {
    const fbb_level *const l = &fbb_levels[level];
    for (int i = 0; i < FBB_COUNT(count); i++) {
      for (int planes = 1; planes < 4; planes++) { /* y, z, both */
        const fbb_basis basis = {planes & 1 ? count[i] : 0, planes & 2 ? count[i] : 0, 0};
        const int rigid = l->effects == FB_EFFECTS_RIGID;
        if ((planes & 1) <= c->y && planes / 2 <= c->z && !(rigid && (i > 0 || planes < (c->y | 2 * c->z)))) {
          run_body(c, l, &basis);
        }
      }
    }
  }
}

static void run_strain(const fbb_case *c)
{
  static const fbb_level strain = {"strain", FBB_STRAIN, FB_EFFECTS_STRAIN};
  for (int elements = 1; elements <= 3 && c->root == FB_ROOT_CLAMPED; elements++) {
    const fbb_basis basis = {2 * elements * c->y, 2 * elements * c->z, elements};
    run_body(c, &strain, &basis);
  }
}

/* ---- output */

static int by_cost(const void *a, const void *b)
{
  const double x = ((const fbb_entry *)a)->ns_per_s, y = ((const fbb_entry *)b)->ns_per_s;
  return (x > y) - (x < y);
}

/* By cost. On the front of all, or of its rung, is what errs less than all that is cheaper. */
static void write_entries(FILE *csv, const fbb_case *c)
{
  double best = HUGE_VAL, best_of[FBB_RUNGS];
  for (int k = 0; k < FBB_RUNGS; k++) {
    best_of[k] = HUGE_VAL;
  }
  for (int k = 0; k < n_entry; k++) {
    const fbb_entry *const e = &entry[k];
    const int front = e->error < best, front_of_rung = e->error < best_of[e->rung];
    best = front ? e->error : best;
    best_of[e->rung] = front_of_rung ? e->error : best_of[e->rung];
    fprintf(csv, "%s,%s,%s,%d,%d,%d,%d,%s,%.6g,%.4g,%.6g,%d,%d\n", c->name, fbb_rung_name[e->rung], e->level,
            e->effects, e->basis.y, e->basis.z, e->basis.elements, e->scheme, e->dt,
            e->error < HUGE_VAL ? e->error : 1e9, 1e-3 * e->ns_per_s, front, front_of_rung);
  }
}

/* Time as a multiple of `unit`, which is set where it is zero. */
static void print_cheapest(double tolerance, double *unit)
{
  for (int k = 0; k < n_entry; k++) {
    const fbb_entry *const e = &entry[k];
    if (e->error <= tolerance) {
      char model[32];
      *unit = *unit > 0.0 ? *unit : e->ns_per_s;
      if (e->basis.elements) {
        snprintf(model, sizeof model, "%d elements", e->basis.elements);
      } else {
        snprintf(model, sizeof model, "%d + %d modes", e->basis.y, e->basis.z);
      }
      printf("  %5g %%  %9.3g  %-7s %-12s %-12s %9.3g ms  error %.2g %%\n", 100 * tolerance, e->ns_per_s / *unit,
             e->level, model, e->scheme, 1e3 * e->dt, 100 * e->error);
      return;
    }
  }
  printf("  %5g %%  nothing\n", 100 * tolerance);
}

int main(int argc, char **argv)
{
  static const double tolerance[] = {0.1, 0.01, 0.001};
  const char *const folder = argc > 1 ? argv[1] : ".";
  char path[512];
  FILE *csv;
  snprintf(path, sizeof path, "%s/accuracy.csv", folder);
  csv = fopen(path, "w");
  if (!csv) {
    fprintf(stderr, "%s: cannot be written\n", path);
    return 1;
  }
  fbb_begin();
  printf("cheapest that meets a tolerance: time by that of the first line of the scene, model, scheme, step\n");
  fprintf(csv, "scene,rung,level,effects,y,z,elements,scheme,step_s,error,us_per_s,front,front_of_rung\n");
  for (int s = 0; s < FBB_COUNT(fbb_cases); s++) {
    const fbb_case *const c = &fbb_cases[s];
    double off, unit = 0.0;
    if (argc > 2 && strcmp(argv[2], c->name) != 0) {
      continue;
    }
    fprintf(stderr, "%s\n", c->name);
    n_entry = 0;
    off = make_reference(c);
    run_exact(c);
    run_modal(c);
    run_strain(c);
    qsort(entry, (size_t)n_entry, sizeof entry[0], by_cost);
    write_entries(csv, c);
    printf("%s: %s; %d runs, reference within %.1g %%\n", c->name, c->what, n_entry, 100 * off);
    for (int k = 0; k < FBB_COUNT(tolerance); k++) {
      print_cheapest(tolerance[k], &unit);
    }
    fflush(stdout);
  }
  return fclose(csv) == 0 ? 0 : 1;
}
