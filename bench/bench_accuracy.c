/* bench_accuracy.c - what accuracy costs in time: eight scenes by modal bodies of every set of effects, number of
   modes, integrator and step, and by the geometrically exact beam. The error is the largest over the run of the output
   (case.h) against the exact beam converged in mesh and step, of its largest value; the cost is nanoseconds of stepping
   per simulated second; both of the same run. Writes a CSV to the folder of its argument, tables to standard output. */
#define _POSIX_C_SOURCE 200112L
#define FB_MAX_EXACT 64
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
    fprintf(csv, "%s,%s,%s,%d,%d,%d,%d,%s,%.6g,%.4g,%.6g,%d,%d\n", c->name, fbb_rung_name[e->rung], e->level,
            e->effects, e->basis.y, e->basis.z, e->basis.elements, e->integrator, e->dt,
            e->error < HUGE_VAL ? e->error : 1e9, 1e-3 * e->ns_per_s, front, front_of_rung);
  }
}

/* Time as a multiple of `unit`, which is set where it is zero. */
static void print_cheapest(double tolerance, double *unit)
{
  const fbb_entry *const e = fbb_cheapest(tolerance);
  char model[32];
  if (!e) {
    printf("  %5g %%  nothing\n", 100 * tolerance);
    return;
  }
  *unit = *unit > 0.0 ? *unit : e->ns_per_s;
  if (e->basis.elements) {
    snprintf(model, sizeof model, "%d elements", e->basis.elements);
  } else {
    snprintf(model, sizeof model, "%d + %d modes", e->basis.y, e->basis.z);
  }
  printf("  %5g %%  %9.3g  %-7s %-12s %-12s %9.3g ms  error %.2g %%\n", 100 * tolerance, e->ns_per_s / *unit, e->level,
         model, e->integrator, 1e3 * e->dt, 100 * e->error);
}

int main(int argc, char **argv)
{
  static const double tolerance[] = {0.1, 0.01, 0.001};
  const char *const folder = argc > 1 ? argv[1] : ".";
  char path[512];
  FILE *csv;
  output_begin("bench_accuracy");
  snprintf(path, sizeof path, "%s/accuracy.csv", folder);
  csv = fopen(path, "w");
  if (!csv) {
    fprintf(stderr, "%s: cannot be written\n", path);
    return 1;
  }
  fbb_begin();
  printf("cheapest that meets a tolerance: time by that of the first line of the scene, model, integrator, step\n");
  fprintf(csv, "scene,rung,level,effects,y,z,elements,integrator,step_s,error,us_per_s,front,front_of_rung\n");
  for (int s = 0; s < FBB_COUNT(fbb_cases); s++) {
    const fbb_case *const c = &fbb_cases[s];
    double off, unit = 0.0;
    if (argc > 2 && strcmp(argv[2], c->name) != 0) {
      continue;
    }
    fprintf(stderr, "%s\n", c->name);
    off = fbb_climb(c);
    write_entries(csv, c);
    printf("%s: %s; %d runs, reference within %.1g %%\n", c->name, c->what, fbb_n_entry, 100 * off);
    for (int k = 0; k < FBB_COUNT(tolerance); k++) {
      print_cheapest(tolerance[k], &unit);
    }
    fflush(stdout);
  }
  return output_close(csv, path);
}
