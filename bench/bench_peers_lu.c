/* bench_peers_lu - fb_lu_factor and fb_lu_solve beside LAPACK's dgetrf and dgetrs, CSV on stdout. 16 random matrices of
   a size, each in the order its library wants; ours and theirs take turns by all of them, so that they share what
   disturbs the machine. The solutions are checked to be the same. bench/peers.sh builds and runs it, on one thread.
   Exit: 0, 1 when a factorization fails or the solutions differ. */
#define _GNU_SOURCE /* RTLD_DEFAULT; clock_gettime, uname */
#define FLEXBEAM_IMPLEMENTATION
#include "random.h"
#include "report.h"
#include "../examples/common/output.h"
#include <dlfcn.h>
#include <math.h>

#define SIZE 48
#define MATRICES 16
#define RUNS 301

void dgetrf_(const int *m, const int *n, double *A, const int *lda, int *pivots, int *info);
void dgetrs_(const char *trans, const int *n, const int *columns, const double *A, const int *lda, const int *pivots,
             double *b, const int *ldb, int *info, size_t trans_length);
void ilaver_(int *major, int *minor, int *patch);

enum { FACTOR, SOLVE, KINDS };
enum { OURS, LAPACK, CODES };

typedef struct problem {
  double A[SIZE * SIZE], LU[CODES][SIZE * SIZE]; /* factors */
  double b[SIZE], x[CODES][SIZE];
  int pivots[CODES][SIZE];
} problem;

static problem problems[MATRICES];
static double scale[SIZE], sample[KINDS][CODES][RUNS];
static double overhead; /* [ns] of an empty measurement */

/* OpenBLAS where it is loaded, or the version of LAPACK. */
static void name_library(char *name, size_t size)
{
  const char *(*config)(void);
  void *symbol = dlsym(RTLD_DEFAULT, "openblas_get_config");
  int version[3];
  if (symbol) {
    memcpy(&config, &symbol, sizeof config);
    snprintf(name, size, "%.*s", (int)strcspn(config() + 9, " ") + 9, config()); /* OpenBLAS 0.3.21 NO_AFFINITY ... */
  } else {
    ilaver_(&version[0], &version[1], &version[2]);
    snprintf(name, size, "LAPACK %d.%d.%d", version[0], version[1], version[2]);
  }
}

static void fail(const char *what, int n)
{
  fprintf(stderr, "bench_peers_lu: n = %d: %s\n", n, what);
  exit(1);
}

static void fill(int n)
{
  for (int k = 0; k < MATRICES; k++) {
    problem *p = &problems[k];
    for (int i = 0; i < n * n; i++) {
      p->A[i] = fbb_random(10000 * k + i);
    }
    for (int i = 0; i < n; i++) {
      p->b[i] = fbb_random(10000 * k + SIZE * SIZE + i);
    }
  }
}

/* What the four do with one problem. */
static void factor_ours(problem *p, int n)
{
  fbb_check(fb_lu_factor(p->LU[OURS], p->pivots[OURS], scale, n), "fb_lu_factor");
}

static void factor_lapack(problem *p, int n)
{
  int info;
  dgetrf_(&n, &n, p->LU[LAPACK], &n, p->pivots[LAPACK], &info);
  if (info != 0) {
    fail("dgetrf", n);
  }
}

static void solve_ours(problem *p, int n)
{
  fb_lu_solve(p->x[OURS], p->LU[OURS], p->pivots[OURS], p->b, n);
}

static void solve_lapack(problem *p, int n)
{
  static const int one = 1;
  int info;
  memcpy(p->x[LAPACK], p->b, sizeof p->b[0] * (size_t)n);
  dgetrs_("N", &n, &one, p->LU[LAPACK], &n, p->pivots[LAPACK], p->x[LAPACK], &n, &info, 1);
}

static void measure(int n)
{
  static void (*const work[KINDS][CODES])(problem * p, int n) = {{factor_ours, factor_lapack},
                                                                 {solve_ours, solve_lapack}};
  for (int run = 0; run < RUNS; run++) {
    for (int k = 0; k < MATRICES; k++) {
      problem *p = &problems[k];
      for (int i = 0; i < n * n; i++) {
        p->LU[OURS][i] = p->LU[LAPACK][i % n * n + i / n] = p->A[i];
      }
    }
    for (int at = 0; at < KINDS * CODES; at++) {
      const double start = clock_ns();
      for (int k = 0; k < MATRICES; k++) {
        work[at / CODES][at % CODES](&problems[k], n);
      }
      sample[at / CODES][at % CODES][run] = (clock_ns() - start - overhead) / MATRICES;
    }
  }
}

/* The largest difference of the solutions, by the largest element. */
static double difference(int n)
{
  double most = 0;
  for (int k = 0; k < MATRICES; k++) {
    double size = 0, apart = 0;
    for (int i = 0; i < n; i++) {
      size = fmax(size, fabs(problems[k].x[OURS][i]));
      apart = fmax(apart, fabs(problems[k].x[OURS][i] - problems[k].x[LAPACK][i]));
    }
    most = fmax(most, apart / size);
  }
  return most;
}

int main(void)
{
  static const int sizes[] = {6, 8, 10, 12, 16, 20, 24, 32, 40, 48};
  char library[64];
  output_begin("bench_peers_lu");
  overhead = fbb_begin();
  name_library(library, sizeof library);
  printf(
      "# ns of a factorization and of a solution, %d runs of %d matrices; ratio: of the medians, LAPACK to flexbeam\n",
      RUNS, MATRICES);
  printf("library,n,what,flexbeam min,flexbeam median,LAPACK min,LAPACK median,ratio,difference\n");
  for (int s = 0; s < (int)(sizeof sizes / sizeof sizes[0]); s++) {
    const int n = sizes[s];
    fill(n);
    measure(n);
    for (int kind = 0; kind < KINDS; kind++) {
      const clock_timing ours = clock_timing_of(sample[kind][OURS], RUNS);
      const clock_timing theirs = clock_timing_of(sample[kind][LAPACK], RUNS);
      printf("%s,%d,%s,%.0f,%.0f,%.0f,%.0f,%.2f,%.1e\n", library, n, kind == FACTOR ? "factor" : "solve", ours.lowest,
             ours.median, theirs.lowest, theirs.median, theirs.median / ours.median, difference(n));
    }
    if (!(difference(n) < 1e-8)) {
      fail("the solutions differ", n);
    }
  }
  return 0;
}
