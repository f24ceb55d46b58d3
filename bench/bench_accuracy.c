/* bench_accuracy.c - what accuracy costs in time: eight scenes by modal bodies of every set of effects, number of
   modes, integrator and step, by geometrically exact ones (FB_EFFECTS_LARGE) of several bases and numbers of points, and
   by the geometrically exact beam. The error is the largest over the run of the output (case.h) against the exact beam
   converged in mesh and step, of its largest value; the cost is nanoseconds of stepping per simulated second; both of
   the same run. A body of many modes is the second reference: both must agree. Writes a CSV to the folder of its
   argument, tables to standard output. Exit: 0, 1 when the references differ by more than 0.01 % or a target is missed.
   */
#define _POSIX_C_SOURCE 200112L
#define FB_MAX_EXACT 128
#define FB_MAX_MODES 20
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"

#include "ladder.h"
#include "report.h"
#include "../examples/common/output.h"

/* ---- output */

/* By cost. On the front of all, or of its rung, is what errs less than all that is cheaper. */
static void write_entries(FILE *csv, const fbb_case *c)
{
  double best = HUGE_VAL, best_of[FBB_RUNGS];
  for (int k = 0; k < FBB_RUNGS; k++) {
    best_of[k] = HUGE_VAL;
  }
  for (int k = 0; k < fbb_n_entry; k++) {
    const fbb_entry *const e = &fbb_entries[k];
    const int front = e->error < best, front_of_rung = e->error < best_of[e->rung];
    best = front ? e->error : best;
    best_of[e->rung] = front_of_rung ? e->error : best_of[e->rung];
    fprintf(csv, "%s,%s,%s,%d,%d,%d,%d,%s,%.6g,%.4g,%.6g,%d,%d,%d,%g,%d\n", c->name, fbb_rung_name[e->rung], e->level,
            e->effects, e->basis.y, e->basis.z, e->basis.elements, e->integrator, e->dt,
            e->error < HUGE_VAL ? e->error : 1e9, 1e-3 * e->ns_per_s, front, front_of_rung, e->basis.load,
            e->basis.spin, e->basis.points);
  }
}

/* What a basis has beside natural modes, and its points. */
static void print_basis(const fbb_entry *e)
{
  const fbb_basis *const b = &e->basis;
  if (e->rung == FBB_LARGE) {
    printf(", %d points", b->points);
  }
  if (b->spin != 0.0 || b->load) {
    printf(", modes%s%s%s", b->spin != 0.0 ? " of the spin" : "", b->spin != 0.0 && b->load ? " and" : "",
           b->load ? " of the load" : "");
  }
}

/* Time as a multiple of `unit`, which is set where it is zero; 0: nothing meets the tolerance. */
static double print_cheapest(double tolerance, double *unit)
{
  const fbb_entry *const e = fbb_cheapest(tolerance);
  char model[32];
  if (!e) {
    printf("  %5g %%  nothing\n", 100 * tolerance);
    return 0.0;
  }
  *unit = *unit > 0.0 ? *unit : e->ns_per_s;
  if (e->basis.elements) {
    snprintf(model, sizeof model, "%d elements", e->basis.elements);
  } else {
    snprintf(model, sizeof model, "%d + %d modes", e->basis.y, e->basis.z);
  }
  printf("  %5g %%  %9.3g  %-7s %-12s %-12s %9.3g ms  error %.2g %%", 100 * tolerance, e->ns_per_s / *unit, e->level,
         model, e->integrator, 1e3 * e->dt, 100 * e->error);
  print_basis(e);
  printf("\n");
  return e->ns_per_s / *unit;
}

/* ---- targets */

typedef struct scene_result {
  const char *name;
  double ratio[4]; /* of time, by tolerance */
  double off, second;
} scene_result;

/* Time of 1 % and 0.1 % by that of 10 %, and what the references say. Returns how many scenes miss a target. */
static int print_targets(const scene_result *r, int n)
{
  int missed = 0;
  printf("time by that of 10 %%: at most 15 for 1 %%, 40 for 0.1 %%; references: estimated error, difference at most "
         "0.01 %%\n");
  printf("scene             1 %%     0.1 %%    0.01 %%     estimate  difference\n");
  for (int k = 0; k < n; k++) {
    const int bad = !(r[k].ratio[1] > 0.0 && r[k].ratio[1] <= 15.0 && r[k].ratio[2] > 0.0 && r[k].ratio[2] <= 40.0 &&
                      r[k].second <= 1e-4);
    printf("%-10s", r[k].name);
    for (int t = 1; t < 4; t++) {
      if (r[k].ratio[t] > 0.0) {
        printf(" %9.3g", r[k].ratio[t]);
      } else {
        printf("         -");
      }
    }
    printf("  %9.1g %%  %8.1g %%%s\n", 100 * r[k].off, 100 * r[k].second, bad ? "  missed" : "");
    missed += bad;
  }
  return missed;
}

int main(int argc, char **argv)
{
  static const double tolerance[] = {0.1, 0.01, 0.001, 0.0001};
  static scene_result result[FBB_COUNT(fbb_cases)];
  const char *const folder = argc > 1 ? argv[1] : ".";
  char path[512];
  FILE *csv;
  int n = 0, missed, status;
  output_begin("bench_accuracy");
  snprintf(path, sizeof path, "%s/accuracy.csv", folder);
  csv = fopen(path, "w");
  if (!csv) {
    fprintf(stderr, "%s: cannot be written\n", path);
    return 1;
  }
  fbb_begin();
  printf("cheapest that meets a tolerance: time by that of the first line of the scene, model, integrator, step\n");
  fprintf(
      csv,
      "scene,rung,level,effects,y,z,elements,integrator,step_s,error,us_per_s,front,front_of_rung,load,spin,points\n");
  for (int s = 0; s < FBB_COUNT(fbb_cases); s++) {
    const fbb_case *const c = &fbb_cases[s];
    scene_result *const r = &result[n];
    double unit = 0.0;
    if (argc > 2 && strcmp(argv[2], c->name) != 0) {
      continue;
    }
    fprintf(stderr, "%s\n", c->name);
    r->name = c->name;
    r->off = fbb_climb(&r->second, c, 0);
    write_entries(csv, c);
    printf("%s: %s; %d runs, references within %.1g %% and %.1g %% apart\n", c->name, c->what, fbb_n_entry,
           100 * r->off, 100 * r->second);
    for (int k = 0; k < FBB_COUNT(tolerance); k++) {
      r->ratio[k] = print_cheapest(tolerance[k], &unit);
    }
    fflush(stdout);
    n++;
  }
  missed = print_targets(result, n);
  status = output_close(csv, path);
  return status ? status : missed > 0;
}
