/* fbt.h - the test harness: nothing but a C compiler.
   Each tests/test_<section>.c or test_<section>_<topic>.c defines static tests with TEST(name) and lists them in
   SUITE(section, ...) or SUITE(section_topic, ...); a test that is not listed fails the build (-Wunused-function).
   Every test file is a translation unit of its own and sees only flexbeam.h; the code itself is in test_main.c. */
#ifndef FBT_H
#define FBT_H

/* Three elements with cubic functions in three directions have nineteen coordinates, two of degree 6 in a plane
   twenty-one and twenty-two strain stations. */
#ifndef FB_MAX_MODES
#define FB_MAX_MODES 24
#endif
#ifndef FB_MAX_STRAINS
#define FB_MAX_STRAINS 24
#endif
#ifndef FB_MAX_ROWS
#define FB_MAX_ROWS 60
#endif
#ifndef FB_MAX_LOOPS
#define FB_MAX_LOOPS 8
#endif
#ifndef FB_WITH_FORMS
#define FB_WITH_FORMS 1 /* beside what ships, which does not know of it */
#endif
#include "../flexbeam.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef FBT_REFERENCE
#define FBT_REFERENCE "tests/reference/"
#endif

typedef struct fbt_case {
  const char *name;
  void (*run)(void);
  int lasts; /* 1: shows no line or branch of the library that others do not: --brief leaves it out */
} fbt_case;

#define FBT_COUNT(array) ((int)(sizeof(array) / sizeof((array)[0])))
/* At file scope: the array has one element for each of `count` enumerators, else it does not compile. */
#define FBT_ONE_EACH(array, count) typedef char array##_one_each[FBT_COUNT(array) == (int)(count) ? 1 : -1]
#define TEST(name) static void name(void)
#define RUN(name)  \
  {                \
#name, name, 0 \
  }
#define RUN_LONG(name) \
  {                    \
#name, name, 1     \
  }
#define SUITE(section, ...)                        \
  void fbt_suite_##section(void);                  \
  void fbt_suite_##section(void)                   \
  {                                                \
    static const fbt_case cases[] = {__VA_ARGS__}; \
    fbt_run(#section, cases, FBT_COUNT(cases));    \
  }

/* A tolerance for double and one for single precision. */
#define FBT_TOL(in_double, in_single) (FB_SINGLE ? (in_single) : (in_double))

/* The forms of the equations of motion and the stiffness torques, by number. */
enum { FBT_MOMENTUM = FB_FORM_MOMENTUM, FBT_SECOND = FB_FORM_SECOND, FBT_FIRST = FB_FORM_FIRST, FBT_FORMS = 3 };
enum { FBT_IDENTITY = FB_TORQUE_IDENTITY, FBT_PRINTED = FB_TORQUE_PRINTED, FBT_BOUNDARY = FB_TORQUE_BOUNDARY };

/* Steps or seconds of a long run. Sanitizers (tests/checks/common.sh) set FBT_SHORT: the code that a step runs
   through is the same in every step, a short run shows them all of it, under the same bounds. */
#ifndef FBT_SHORT
#define FBT_SHORT 0
#endif
#define FBT_LONG(whole, brief) (FBT_SHORT ? (brief) : (whole))

/* 1: the first claim that does not hold ends the run (tests/mutants/mutants.sh asks no more than that). */
#ifndef FBT_STOP
#define FBT_STOP 0
#endif

/* The running test fails, with place and text, when a claim does not hold. All are printed up to a few per test.
   It also fails by a claim that cannot fail: one whose bound is not below the size of what it compares at any time that
   the test makes it. Sizes are:
     FBT_NEAR_ABS   |expected|; 0 is without a size, but for arrays (fbt_difference)
     FBT_NEAR_REL   1: the bound is relative
     FBT_ZERO       the size that is given, with a bound relative to it: |got| <= tol size. For errors and residuals
     FBT_BELOW      of fbt_difference the largest element; an error below FBT_TOL(...) is without a size
   Without a size a bound of 1 or more is refused: say the size by FBT_ZERO. What single precision cannot decide is a claim
   of double alone: FBT_DOUBLE_ONLY("why") before it. */
#define FBT_TRUE(claim) fbt_check((claim) != 0, __FILE__, __LINE__, #claim, 0.0, 0.0, 0.0)
#define FBT_FAIL(text) fbt_check(0, __FILE__, __LINE__, text, 0.0, 0.0, 0.0)
#define FBT_INT_EQ(got, expected) fbt_equal((int)(got), (int)(expected), __FILE__, __LINE__, #got " == " #expected)
#define FBT_NEAR_ABS(got, expected, tol) \
  (fbt_compared = 0.0,                   \
   fbt_near((double)(got), (double)(expected), (double)(tol), 0.0, __FILE__, __LINE__, #got " ~ " #expected))
#define FBT_NEAR_REL(got, expected, tol)                                              \
  fbt_near((double)(got), (double)(expected), 0.0, (double)(tol), __FILE__, __LINE__, \
           #got " ~ " #expected " (relative)")
#define FBT_ZERO(got, size, tol) \
  fbt_zero((double)(got), (double)(size), (double)(tol), __FILE__, __LINE__, #got " ~ 0 of " #size)
#define FBT_BELOW(got, limit) \
  (fbt_compared = 0.0, fbt_below((double)(got), (double)(limit), __FILE__, __LINE__, #got " < " #limit))
#define FBT_DOUBLE_ONLY(why) if (!FB_SINGLE)

/* A measured figure for the table of tests/VERIFICATION.md (--figures): what, against which source, how
   much. */
void fbt_figure(const char *what, const char *source, double value);

void fbt_run(const char *section, const fbt_case *cases, int n);
void fbt_check(int ok, const char *file, int line, const char *claim, double got, double expected, double tol);
void fbt_equal(int got, int expected, const char *file, int line, const char *claim);
void fbt_near(double got, double expected, double abs_tol, double rel_tol, const char *file, int line,
              const char *claim);
void fbt_zero(double got, double size, double tol, const char *file, int line, const char *claim);
void fbt_below(double got, double limit, const char *file, int line, const char *claim);

/* Repeatable random numbers: uniform in (-1, 1), and a whole array of them. */
void fbt_seed(unsigned seed);
double fbt_random(void);
void fbt_fill(fb_real *x, int n, double scale);
/* Largest |a_i - b_i|, of which fbt_compared is the size, and largest |a_i|. */
extern double fbt_compared;
double fbt_difference(const fb_real *a, const fb_real *b, int n);
double fbt_largest(const fb_real *a, int n);
/* Rates of v in body axes, from the acceleration of O: a - w x v. Static: until the next call. */
const fb_real *fbt_v_dot(const fb_motion *motion);

/* Bytes of a struct of which one bit can flip without a change of its check word; more than all of them: the word is
   0. A short run looks at every seventh byte. */
int fbt_unseen(void *at, size_t size, unsigned (*word)(void));

/* A reference CSV: '#' lines skipped, header line, rows of numbers or words. */
typedef struct fbt_table {
  int rows, columns;
  char header[64][32];
  char cell[256][64][40];
} fbt_table;
/* Reads FBT_REFERENCE name; the test fails if it cannot. The table is static: one at a time. */
const fbt_table *fbt_reference(const char *name);
double fbt_value(const fbt_table *table, int row, const char *column);
const char *fbt_word(const fbt_table *table, int row, const char *column);

/* Damping ratios and gravity only where the effects use them: others are refused. */
static inline void fbt_fit(fb_body_desc *desc)
{
  if (!(desc->effects & FB_EFFECT_DAMPING)) {
    memset(desc->zeta, 0, sizeof desc->zeta);
  }
  if (!(desc->effects & FB_EFFECT_GRAVITY)) {
    memset(desc->gravity, 0, sizeof desc->gravity);
  }
}

/* Number of models that a system has, for an array that holds more. */
static inline int fbt_models(const fb_system_desc *desc)
{
  int n = 0;
  for (int k = 0; k < desc->n_body; k++) {
    n = desc->model[k] >= n ? desc->model[k] + 1 : n;
  }
  return n;
}

/* fb_modes_join with its description by arguments. */
static inline fb_status joined_by(fb_modes *joined, fb_join_work *work, const fb_beam *beam, const fb_modes *component,
                                  int n_component, const fb_weld *weld, int n_weld, int lowest, fb_real omega_limit)
{
  fb_join_desc desc;
  memset(&desc, 0, sizeof desc);
  desc.n_weld = n_weld;
  for (int k = 0; k < n_weld; k++) {
    desc.weld[k] = weld[k];
  }
  desc.lowest = lowest;
  desc.omega_limit = omega_limit;
  return fb_modes_join(joined, work, beam, component, &desc, n_component);
}

#endif
