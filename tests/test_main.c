/* Runs every suite and closes with "N passed, N failed". Optional arguments:
   only the tests whose section/name or section/topic/name contains it (`body/`
   is all tests of that section); --brief: all but those that last; --part=K/N: the Kth of N parts of them; --list: their names
   alone; --figures: print the measured figures, fields separated by |. */
#ifndef FBT_SEPARATE /* set where another file holds the implementation */
#define FLEXBEAM_IMPLEMENTATION
#endif
#include "fbt.h"

/* In this order they run. */
// clang-format off
#define SUITES(X) \
  X(status) X(status_detail) X(vec3) X(rotation) X(linalg) X(beam) \
  X(modes_frequencies) X(modes_components) X(modes_selection) \
  X(body_particles) X(body_coordinates) X(body_integrals) X(body_motion) X(body_joined) X(body_imports) X(body_strain) X(body_rotors) X(body_gravity) X(body_refusals) X(body_build) \
  X(line_parts) X(line_loads) X(line_refusals) \
  X(forms) X(integrate_forms) \
  X(integrate_limits) X(integrate_implicit) X(integrate_order) X(integrate_stepper) X(integrate_lines) \
  X(system_trees) X(system_joints) X(system_loops) X(system_rows) X(system_steps) X(system_lines) X(system_machines) X(system_rotors) X(system_gravity) X(system_springs) X(system_moorings) X(system_friction) X(system_references) X(system_refusals) \
  X(line_kinematics) X(line_statics) X(line_motion) \
  X(exact_statics) X(exact_motion) X(exact_joints) X(exact_branches) X(exact_supports) X(exact_flight) X(exact_spectrum) X(exact_linear) \
  X(analyse_body) X(analyse_rotors) X(analyse_steps) X(analyse_system) X(analyse_loops) X(analyse_lines) X(analyse_orbit) \
  X(advise_formulas) X(advise_search) X(advise_rotors) X(build)
// clang-format on

#define DECLARE(section) void fbt_suite_##section(void);
SUITES(DECLARE)

static int passed, failed, claims_failed;
static int figures, brief, list, number, part, parts = 1;
static const char *only = "", *running = "";
static unsigned long long random_state = 1;
double fbt_compared;

/* What a line of the running test claims: the largest size over bound, where sizes are known, else the least bound. */
typedef struct site {
  const char *file, *claim;
  int line, sized;
  double ratio, bound;
} site;
static site sites[400];
static int n_site;

void fbt_check(int ok, const char *file, int line, const char *claim, double got, double expected, double tol)
{
  if (!ok) {
    claims_failed++;
    if (claims_failed <= 5) {
      printf("  %s:%d: %s: got %.17g, expected %.17g, tolerance %g\n", file, line, claim, got, expected, tol);
    }
#if FBT_STOP
    exit(1);
#endif
  }
}

void fbt_equal(int got, int expected, const char *file, int line, const char *claim)
{
  fbt_check(got == expected, file, line, claim, got, expected, 0.0);
}

/* size 0: not known */
static void weigh(double size, double bound, const char *file, int line, const char *claim)
{
  int k = 0;
  while (k < n_site && (sites[k].line != line || strcmp(sites[k].file, file) != 0)) {
    k++;
  }
  if (k == FBT_COUNT(sites)) {
    FBT_FAIL("a test has no more lines with claims than `sites`");
    return;
  }
  if (k == n_site) {
    n_site++;
    memset(&sites[k], 0, sizeof sites[k]);
    sites[k].file = file;
    sites[k].claim = claim;
    sites[k].line = line;
    sites[k].bound = HUGE_VAL;
  }
  sites[k].sized |= size > 0.0;
  sites[k].ratio = size > bound * sites[k].ratio ? size / bound : sites[k].ratio;
  sites[k].bound = bound < sites[k].bound ? bound : sites[k].bound;
}

static void refuse_claims_that_cannot_fail(void)
{
  for (int k = 0; k < n_site; k++) {
    const site *const s = &sites[k];
    const int can_fail = s->sized ? s->ratio > 1.0 : s->bound < 1.0;
    char text[400];
    snprintf(text, sizeof text, "%.300s cannot fail: its bound is not below the size of what it compares", s->claim);
    fbt_check(can_fail, s->file, s->line, text, 0.0, s->sized ? s->ratio * s->bound : 1.0, s->bound);
  }
  n_site = 0;
}

void fbt_near(double got, double expected, double abs_tol, double rel_tol, const char *file, int line,
              const char *claim)
{
  const double tol = abs_tol + rel_tol * fabs(expected);
  weigh(rel_tol > 0.0 ? 1.0 : expected == 0.0 ? fbt_compared : fabs(expected), abs_tol + rel_tol, file, line, claim);
  fbt_check(fabs(got - expected) <= tol, file, line, claim, got, expected, tol);
}

void fbt_zero(double got, double size, double tol, const char *file, int line, const char *claim)
{
  weigh(1.0, size > 0.0 && tol * size < HUGE_VAL ? tol : HUGE_VAL, file, line, claim);
  fbt_check(fabs(got) <= tol * size, file, line, claim, got, 0.0, tol * size);
}

void fbt_below(double got, double limit, const char *file, int line, const char *claim)
{
  if (strstr(claim, " < FBT_TOL(") || fbt_compared > 0.0 || !(limit < HUGE_VAL)) {
    weigh(fbt_compared, limit, file, line, claim);
  }
  fbt_check(got < limit, file, line, claim, got, limit, 0.0);
}

void fbt_run(const char *section, const fbt_case *cases, int n)
{
  for (int i = 0; i < n; i++) {
    char path[128];
    snprintf(path, sizeof path, "%s/%s", section, cases[i].name);
    path[strcspn(path, "_/")] = '/'; /* a topic of the section */
    if (strstr(path, only) == NULL || (brief && cases[i].lasts) || ++number % parts != part % parts) {
      continue;
    }
    if (list) {
      printf("%s\n", path);
      passed++;
      continue;
    }
    claims_failed = 0;
    running = cases[i].name;
    fbt_seed(1);
    cases[i].run();
    refuse_claims_that_cannot_fail();
    if (!figures || claims_failed) {
      printf("%s %s\n", claims_failed ? "FAIL" : "ok  ", path);
    }
    fflush(stdout);
    passed += claims_failed == 0;
    failed += claims_failed != 0;
  }
}

void fbt_figure(const char *what, const char *source, double value)
{
  if (figures) {
    printf("%s|%s|%.1e|%s\n", what, source, value, running);
  }
}

void fbt_seed(unsigned seed)
{
  random_state = 0x9E3779B97F4A7C15ull * (seed + 1);
}

double fbt_random(void)
{
  random_state = random_state * 6364136223846793005ull + 1442695040888963407ull;
  return (double)(random_state >> 11) / 4503599627370496.0 - 1.0;
}

void fbt_fill(fb_real *x, int n, double scale)
{
  for (int i = 0; i < n; i++) {
    x[i] = (fb_real)(scale * fbt_random());
  }
}

int fbt_unseen(void *at, size_t size, unsigned (*word)(void))
{
  const unsigned whole = word();
  const size_t every = FBT_LONG(1, 7); /* byte */
  unsigned char *const byte = (unsigned char *)at;
  size_t unseen = 0;
  for (size_t k = 0; k < size; k += every) {
    byte[k] = (unsigned char)(byte[k] ^ (1u << k % 8));
    unseen += word() == whole;
    byte[k] = (unsigned char)(byte[k] ^ (1u << k % 8));
  }
  return (int)(whole == 0 ? size + 1 : unseen);
}

double fbt_difference(const fb_real *a, const fb_real *b, int n)
{
  const double size = fmin(fbt_largest(a, n), fbt_largest(b, n)); /* 0: a claim of zero */
  double largest = 0.0;
  for (int i = 0; i < n; i++) {
    const double d = fabs((double)a[i] - (double)b[i]);
    largest = d > largest || d != d ? d : largest;
  }
  fbt_compared = fmax(fbt_compared, size);
  return largest;
}

double fbt_largest(const fb_real *a, int n)
{
  double largest = 0.0;
  for (int i = 0; i < n; i++) {
    largest = fabs((double)a[i]) > largest ? fabs((double)a[i]) : largest;
  }
  return largest;
}

const fb_real *fbt_v_dot(const fb_motion *motion)
{
  static fb_real rate[3];
  fb_vec3_cross(rate, motion->w, motion->v);
  for (int i = 0; i < 3; i++) {
    rate[i] = motion->acceleration[i] - rate[i];
  }
  return rate;
}

static int split(char cells[64][40], char *line)
{
  int n = 0;
  line[strcspn(line, "\r\n")] = 0;
  for (char *p = line; p && n < 64; n++) {
    char *comma = strchr(p, ',');
    if (comma) {
      *comma++ = 0;
    }
    snprintf(cells[n], 40, "%.39s", p);
    p = comma;
  }
  return n;
}

const fbt_table *fbt_reference(const char *name)
{
  static fbt_table table;
  static char line[8192];
  static char header[64][40];
  char path[256];
  FILE *file;
  memset(&table, 0, sizeof table);
  snprintf(path, sizeof path, "%s%s", FBT_REFERENCE, name);
  file = fopen(path, "r");
  FBT_TRUE(file != NULL);
  if (!file) {
    printf("  cannot read %s: run the tests from the top of the project\n", path);
    return &table;
  }
  while (fgets(line, sizeof line, file)) {
    if (line[0] == '#' || line[0] == '\n') {
      continue;
    }
    if (table.columns == 0) {
      table.columns = split(header, line);
      for (int i = 0; i < table.columns; i++) {
        snprintf(table.header[i], 32, "%.31s", header[i]);
      }
    } else if (table.rows < 256) {
      (void)split(table.cell[table.rows], line);
      table.rows++;
    }
  }
  fclose(file);
  FBT_TRUE(table.rows > 0);
  return &table;
}

const char *fbt_word(const fbt_table *table, int row, const char *column)
{
  for (int i = 0; i < table->columns; i++) {
    if (strcmp(table->header[i], column) == 0 && row < table->rows) {
      return table->cell[row][i];
    }
  }
  FBT_FAIL("column exists in the reference");
  return "nan";
}

double fbt_value(const fbt_table *table, int row, const char *column)
{
  return strtod(fbt_word(table, row, column), NULL);
}

int main(int argc, char **argv)
{
  for (int i = 1; i < argc; i++) {
    figures = figures || strcmp(argv[i], "--figures") == 0;
    brief = brief || strcmp(argv[i], "--brief") == 0;
    list = list || strcmp(argv[i], "--list") == 0;
    if (strncmp(argv[i], "--part", 6) == 0 &&
        (sscanf(argv[i], "--part=%d/%d", &part, &parts) != 2 || parts < 1 || part < 1 || part > parts)) {
      printf("--part=K/N: K from 1 to N; it is %s\n", argv[i]);
      return 2;
    }
    only = argv[i][0] == '-' ? only : argv[i];
  }
  if (!figures && !list) {
    printf("flexbeam %s, %s\n", fb_version_string(), fb_config_string());
  }
#define CALL(section) fbt_suite_##section();
  SUITES(CALL)
  if ((!figures && !list) || failed) {
    printf("%d passed, %d failed\n", passed, failed);
  }
  return failed != 0 || passed == 0;
}
