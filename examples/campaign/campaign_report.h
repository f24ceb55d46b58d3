/* campaign_report.h - what a campaign has found: a CSV file with a row per run, moments and quantiles of every measure,
   their rank correlation with every parameter, and pictures of the strongest. */
#ifndef CAMPAIGN_REPORT_H
#define CAMPAIGN_REPORT_H
#include "campaign_ledger.h"
#include "../common/plot.h"

#define REPORT_COLUMNS (CAMPAIGN_VARY + SCENE_MEASURES)

typedef struct report_place { /* a value and where it stands */
  double value;
  int at;
} report_place;

typedef struct report { /* of the n runs that are ok, in their order */
  const ledger *l;
  int n;
  double *column[REPORT_COLUMNS]; /* parameters, then measures */
  double *rank[REPORT_COLUMNS], *sorted;
  int *run; /* their numbers */
  report_place *place;
} report;

/* ---- rows */

static void report_quote(FILE *csv, const char *text)
{
  fputc('"', csv);
  for (const char *p = text; *p; p++) {
    fputs(*p == '"' ? "\"\"" : (const char[2]){*p, 0}, csv);
  }
  fputc('"', csv);
}

static void report_row(FILE *csv, const ledger *l, int run)
{
  double value[CAMPAIGN_VARY];
  char number[32];
  campaign_draw(l->c, value, run);
  fprintf(csv, "%d", run + 1);
  for (int i = 0; i < l->c->n_vary; i++) {
    ledger_number(number, value[i]);
    fprintf(csv, ",%s", number);
  }
  for (int i = 0; i < l->n_measure; i++) {
    ledger_number(number, ledger_measured(l, run)[i]);
    fprintf(csv, ",%s", l->status[run] == ROW_OK ? number : "");
  }
  fprintf(csv, ",%s,", row_words[l->status[run]]);
  if (l->message[run]) {
    report_quote(csv, l->message[run]);
  }
  fputc('\n', csv);
}

/* All that is done, in the order of the runs, whatever the order in which they ended. */
static int report_csv(const ledger *l, const char *path)
{
  FILE *csv = output_open(path);
  char why[OUTPUT_NAME + 128];
  if (!csv) {
    return ledger_fail(l, path, output_why());
  }
  fputs("run", csv);
  for (int i = 0; i < l->c->n_vary; i++) {
    fprintf(csv, ",%s", l->c->vary[i].name);
  }
  for (int i = 0; i < l->n_measure; i++) {
    fprintf(csv, ",%s", l->label[i]);
  }
  fputs(",status,message\n", csv);
  for (int run = 0; run < l->c->runs; run++) {
    if (l->status[run] != ROW_NONE && l->status[run] != ROW_GIVEN) {
      report_row(csv, l, run);
    }
  }
  if (!output_is_whole(csv, path)) {
    snprintf(why, sizeof why, "%s%s", errno ? strerror(errno) : "cannot be written", output_left(path));
    return ledger_fail(l, path, why);
  }
  return 0;
}

/* ---- statistics */

static int report_ascending(const void *a, const void *b)
{
  return clock_ascending(&((const report_place *)a)->value, &((const report_place *)b)->value);
}

/* Ranks 1 .. n; equal values share the middle of theirs. */
static void report_ranks(const report *r, double *rank, const double *x)
{
  for (int k = 0; k < r->n; k++) {
    r->place[k].value = x[k];
    r->place[k].at = k;
  }
  qsort(r->place, (size_t)r->n, sizeof *r->place, report_ascending);
  for (int first = 0, end; first < r->n; first = end) {
    for (end = first + 1; end < r->n && !(r->place[end].value > r->place[first].value);) {
      end++;
    }
    for (int k = first; k < end; k++) {
      rank[r->place[k].at] = 0.5 * (first + 1 + end);
    }
  }
}

static double report_mean(const double *x, int n)
{
  double sum = 0;
  for (int k = 0; k < n; k++) {
    sum += x[k];
  }
  return sum / n;
}

/* Sum of (x - mean x) (y - mean y). */
static double report_moment(const double *x, const double *y, int n)
{
  const double mean_x = report_mean(x, n), mean_y = report_mean(y, n);
  double sum = 0;
  for (int k = 0; k < n; k++) {
    sum += (x[k] - mean_x) * (y[k] - mean_y);
  }
  return sum;
}

/* Spearman's: of the ranks; NaN when one of them is constant. */
static double report_correlation(const report *r, int a, int b)
{
  const double *x = r->rank[a], *y = r->rank[b];
  return report_moment(x, y, r->n) / sqrt(report_moment(x, x, r->n) * report_moment(y, y, r->n));
}

/* Linear between the ordered values (type 7 of Hyndman and Fan, 1996). */
static double report_quantile(const double *sorted, int n, double p)
{
  const double at = (n - 1) * p;
  const int k = (int)at < n - 1 ? (int)at : n - 2;
  return n == 1 ? sorted[0] : sorted[k] + (at - k) * (sorted[k + 1] - sorted[k]);
}

static int report_fill(report *r)
{
  const ledger *l = r->l;
  const int columns = l->c->n_vary + l->n_measure;
  const size_t n = (size_t)(l->done - l->failed) + 1;
  double value[CAMPAIGN_VARY];
  r->place = malloc(n * sizeof *r->place);
  r->sorted = malloc(n * sizeof *r->sorted);
  r->run = malloc(n * sizeof *r->run);
  for (int i = 0; i < columns; i++) {
    r->column[i] = malloc(n * sizeof(double));
    r->rank[i] = malloc(n * sizeof(double));
    if (!r->place || !r->sorted || !r->run || !r->column[i] || !r->rank[i]) {
      return ledger_fail(l, "statistics", "no memory for that many runs");
    }
  }
  for (int run = 0; run < l->c->runs; run++) {
    if (l->status[run] == ROW_OK) {
      campaign_draw(l->c, value, run);
      for (int i = 0; i < columns; i++) {
        r->column[i][r->n] = i < l->c->n_vary ? value[i] : ledger_measured(l, run)[i - l->c->n_vary];
      }
      r->run[r->n++] = run + 1;
    }
  }
  for (int i = 0; i < columns && r->n > 0; i++) {
    report_ranks(r, r->rank[i], r->column[i]);
  }
  return 0;
}

static void report_free(report *r)
{
  free(r->place);
  free(r->sorted);
  free(r->run);
  for (int i = 0; i < REPORT_COLUMNS; i++) {
    free(r->column[i]);
    free(r->rank[i]);
  }
}

/* ---- tables */

/* Runs that are ok have a message where something may be wrong with them all the same. */
static void report_warnings(const ledger *l)
{
  int warned = 0, first = 0;
  for (int run = l->c->runs - 1; run >= 0; run--) {
    if (l->status[run] == ROW_OK && l->message[run]) {
      warned++;
      first = run;
    }
  }
  if (warned > 0) {
    printf("a warning in %d of the runs that are ok, first in run %d: %s\n", warned, first + 1, l->message[first]);
  }
}

static void report_counts(const ledger *l)
{
  int of[ROW_GIVEN + 1] = {0};
  for (int run = 0; run < l->c->runs; run++) {
    of[l->status[run]]++;
  }
  printf("%d run%s: %d ok", l->c->runs, l->c->runs > 1 ? "s" : "", of[ROW_OK]);
  for (int k = ROW_REFUSED; k < ROW_GIVEN; k++) {
    if (of[k]) {
      printf(", %d %s", of[k], row_words[k]);
    }
  }
  printf(l->done < l->c->runs ? ", %d not done\n" : "\n", l->c->runs - l->done);
  report_warnings(l);
}

static void report_moments(const report *r)
{
  static const double p[] = {0, 0.01, 0.05, 0.5, 0.95, 0.99, 1};
  const ledger *l = r->l;
  printf("\n%-24s %12s %10s %10s %10s %10s %10s %10s %10s %10s %10s\n", "measure", "mean", "+-error", "deviation",
         "least", "1 %", "5 %", "50 %", "95 %", "99 %", "most");
  for (int i = 0; i < l->n_measure; i++) {
    const double *x = r->column[l->c->n_vary + i];
    const double deviation = r->n > 1 ? sqrt(report_moment(x, x, r->n) / (r->n - 1)) : 0;
    printf("%-24s %12.6g %10.2g %10.4g", l->title[i], report_mean(x, r->n), deviation / sqrt(r->n), deviation);
    memcpy(r->sorted, x, (size_t)r->n * sizeof *x);
    qsort(r->sorted, (size_t)r->n, sizeof *x, clock_ascending);
    for (int k = 0; k < 7; k++) {
      printf(" %10.5g", report_quantile(r->sorted, r->n, p[k]));
    }
    printf("\n");
  }
}

/* Which runs have the least and the most of a measure: the worst is one of them. Of equal ones the first. */
static void report_extremes(const report *r)
{
  const ledger *l = r->l;
  printf("\n%-24s %12s %10s  (--run K runs it alone)\n", "run with the", "least", "most");
  for (int i = 0; i < l->n_measure; i++) {
    const double *x = r->column[l->c->n_vary + i];
    int least = 0, most = 0;
    for (int k = 1; k < r->n; k++) {
      least = x[k] < x[least] ? k : least;
      most = x[k] > x[most] ? k : most;
    }
    printf("%-24s %12d %10d\n", l->label[i], r->run[least], r->run[most]);
  }
}

/* The part of the runs that are ok that meets a requirement, with the limits between which it is in 19 of 20 cases
   (Wilson, 1927). What the others would have measured nobody knows: they are counted apart. */
static void report_requirement(const report *r, int k)
{
  const campaign *c = r->l->c;
  const double *x = r->column[c->n_vary + ledger_measure(r->l, c->require[k].measure)];
  const double z = 1.96, n = r->n, limit = c->require[k].limit;
  double met = 0, middle, half;
  for (int i = 0; i < r->n; i++) {
    met += c->require[k].above ? x[i] > limit : x[i] < limit;
  }
  middle = (met + 0.5 * z * z) / (n + z * z);
  half = z / (n + z * z) * sqrt(met * (n - met) / n + 0.25 * z * z);
  printf("\n%s %s %g: %.0f of %d runs that are ok, %.1f %% (%.1f to %.1f %%)", c->require[k].measure,
         c->require[k].above ? "above" : "below", limit, met, r->n, 100 * met / n, 100 * fmax(0, middle - half),
         100 * fmin(1, middle + half));
}

static void report_correlations(const report *r)
{
  const ledger *l = r->l;
  printf("\nrank correlation");
  for (int j = 0; j < l->c->n_vary; j++) {
    printf(" %12s", l->c->vary[j].name);
  }
  printf("\n");
  for (int i = 0; i < l->n_measure; i++) {
    printf("%-16s", l->label[i]);
    for (int j = 0; j < l->c->n_vary; j++) {
      const double rho = report_correlation(r, j, l->c->n_vary + i);
      char text[16];
      snprintf(text, sizeof text, isfinite(rho) ? "%.3f" : "-", rho);
      printf(" %*s", (int)fmax(12, (double)strlen(l->c->vary[j].name)), text);
    }
    printf("\n");
  }
  printf("where there is none, chance alone stays below %.2f in 19 of 20 cases\n", 1.96 / sqrt(r->n - 1));
}

/* ---- pictures */

/* The measure and the parameter that hang together most closely. */
static void report_strongest(const report *r, int *measure, int *parameter)
{
  double most = -1;
  *measure = *parameter = 0;
  for (int i = 0; i < r->l->n_measure; i++) {
    for (int j = 0; j < r->l->c->n_vary; j++) {
      const double rho = fabs(report_correlation(r, j, r->l->c->n_vary + i));
      if (rho > most) {
        most = rho;
        *measure = i;
        *parameter = j;
      }
    }
  }
}

/* A histogram of n values has about sqrt n bars. */
static void report_pictures(const report *r, const char *csv)
{
  const ledger *l = r->l;
  int m, p;
  char svg[512], settings[512], columns[256];
  curve points = {csv, columns, "every ::1 with points pt 7 ps 0.4 lc rgb '#0060ad'", "runs"};
  curve bars = {csv, columns, "every ::1 smooth frequency with boxes fill solid 0.5 lc rgb '#0060ad'", "runs"};
  const double *x;
  double least = HUGE_VAL, most = -HUGE_VAL, width;
  report_strongest(r, &m, &p);
  x = r->column[l->c->n_vary + m];
  for (int k = 0; k < r->n; k++) {
    least = fmin(least, x[k]);
    most = fmax(most, x[k]);
  }
  width = (most - least) / ceil(sqrt(r->n));
  if (!(width > 0)) {
    return;
  }
  snprintf(columns, sizeof columns, "%d:%d", 2 + p, 2 + l->c->n_vary + m);
  snprintf(settings, sizeof settings, "unset key\nset xlabel \"%s\" noenhanced\nset ylabel \"%s\" noenhanced\n",
           l->c->vary[p].name, l->title[m]);
  other_name(svg, sizeof svg, csv, "_scatter.svg");
  plot(svg, settings, &points, 1, stdout);
  snprintf(columns, sizeof columns, "(%.17g+%.17g*(0.5+floor(0.999999*($%d-%.17g)/%.17g))):(1)", least, width,
           2 + l->c->n_vary + m, least, width);
  snprintf(settings, sizeof settings,
           "unset key\nset xlabel \"%s\" noenhanced\nset ylabel 'runs'\nset boxwidth %.17g\nset yrange [0:*]\n",
           l->title[m], width);
  other_name(svg, sizeof svg, csv, "_histogram.svg");
  plot(svg, settings, &bars, 1, stdout);
}

/* All of it; a status of main: 0 all runs are ok, 1 some failed, 3 some are not done. */
static int report_write(const ledger *l, const char *csv, int pictures)
{
  static report r;
  int status = report_csv(l, csv);
  r.l = l;
  status = status ? status : report_fill(&r);
  if (!status) {
    report_counts(l);
    if (r.n > 0) {
      report_moments(&r);
      report_extremes(&r);
    }
    if (r.n > 3) {
      report_correlations(&r);
    }
    for (int k = 0; k < l->c->n_require && r.n > 0; k++) {
      report_requirement(&r, k);
    }
    printf(l->c->n_require ? "\n\n" : "\n");
    printf("rows: %s; journal: %s\n", csv, l->path);
    if (r.n > 3 && pictures) {
      report_pictures(&r, csv);
    }
  }
  report_free(&r);
  return status ? status : l->done < l->c->runs ? 3 : l->failed > 0;
}
#endif
