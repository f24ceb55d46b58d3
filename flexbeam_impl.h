/* flexbeam_impl.h - implementation of flexbeam.h, included by it where FLEXBEAM_IMPLEMENTATION is defined.
   One equation, one function, one id: [E8.2] defines, E8.2 cites; tests/reference/THEORY.md derives it and names its
   test.
   Sections follow the life cycle of a model: RUN is the code that flies, BUILD makes models, ANALYSE examines them. A
   section uses only those above it: RUN compiles alone (FB_WITH_BUILD 0), and RUN with BUILD (FB_WITH_ANALYSE 0). */

/* ---------------------------------------------------------------------------------------------------------------
   RUN >>config: libm hooks, configuration symbol, requirements, unrolling */

#if !(defined(FB_SQRT) && defined(FB_SIN) && defined(FB_COS) && defined(FB_ATAN2) && defined(FB_FABS) && \
      defined(FB_EXP))
#include <math.h>
#endif
#if FB_SINGLE
#define FBI_LIBM(name) name##f
#else
#define FBI_LIBM(name) name
#endif
#ifndef FB_SQRT
#define FB_SQRT(x) FBI_LIBM(sqrt)(x)
#endif
#ifndef FB_SIN
#define FB_SIN(x) FBI_LIBM(sin)(x)
#endif
#ifndef FB_COS
#define FB_COS(x) FBI_LIBM(cos)(x)
#endif
#ifndef FB_ATAN2
#define FB_ATAN2(y, x) FBI_LIBM(atan2)(y, x)
#endif
#ifndef FB_FABS
#define FB_FABS(x) FBI_LIBM(fabs)(x)
#endif
#ifndef FB_EXP
#define FB_EXP(x) FBI_LIBM(exp)(x)
#endif
#include <string.h>

#ifndef FLEXBEAM_STATIC
#ifdef __cplusplus
extern "C" {
#endif
#if defined(__GNUC__) && !defined(__clang__)
__attribute__((externally_visible)) /* referenced by the .note sections, which -flto does not see */
#endif
extern const char FBI_CONFIG_SYMBOL[]; /* a const object of C++ has internal linkage without this */
#if defined(__GNUC__)
__attribute__((used))
#endif
const char FBI_CONFIG_SYMBOL[] = FBI_STRING_(FBI_CONFIG_SYMBOL);
#ifdef __cplusplus
}
#endif
#endif

#ifdef FLEXBEAM_STATIC
#define FB_DEF FB_API
#elif defined(__cplusplus)
#define FB_DEF extern "C"
#else
#define FB_DEF
#endif

/* Relative tolerance: a result below this fraction of its summands is treated as round-off, that of a few hundred
   operations. */
#define FBI_ROUNDING ((FB_SINGLE ? FB_R(64.0) : FB_R(1024.0)) * FB_EPSILON)

/* Momenta and frame velocities below this magnitude become zero in a step; those of a slowly rotating body of one gram
   are far larger. */
#define FBI_FAINT (FB_TINY * FB_R(1e-6))

/* Unrolling of the short loops over terms, where loop control is a third of the instructions; -O2 does not unroll them.
   FBI_UNROLL_2 is for loops of few iterations: entering one unrolled by four costs as much as it saves. */
#if defined(__clang__)
#define FBI_UNROLL _Pragma("unroll 4")
#define FBI_UNROLL_2 _Pragma("unroll 2")
#elif defined(__GNUC__)
#define FBI_UNROLL _Pragma("GCC unroll 4")
#define FBI_UNROLL_2 _Pragma("GCC unroll 2")
#else
#define FBI_UNROLL
#define FBI_UNROLL_2
#endif

/* FBI_FLATTEN compiles a step with all its callees in line, except those marked FBI_NOINLINE to limit code size. */
#if defined(__GNUC__)
#define FBI_FLATTEN __attribute__((flatten))
#define FBI_NOINLINE __attribute__((noinline))
#else
#define FBI_FLATTEN
#define FBI_NOINLINE
#endif

/* ---------------------------------------------------------------------------------------------------------------
   RUN >>status: codes and their texts, finite checks (uses config) */

#define FBI_STATUS_TEXT(name, value, text) \
  case name:                               \
    return text;
FB_DEF const char *fb_status_string(fb_status status)
{
  switch (status) {
    FB_STATUS_LIST(FBI_STATUS_TEXT)
  }
  return "unknown status";
}
#undef FBI_STATUS_TEXT

/* FBI_REFUSE(status, what, index, have, need) is that status; with FB_WITH_DETAIL it is recorded with the rest, else
   the rest is not evaluated. FBI_REFUSE_AT: and with `at`. A static function records the public one entered last. */
#if FB_WITH_DETAIL
#if defined(__cplusplus)
#define FBI_THREAD thread_local
#elif defined(__GNUC__)
#define FBI_THREAD __thread
#elif defined(_MSC_VER)
#define FBI_THREAD __declspec(thread)
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define FBI_THREAD _Thread_local
#else
#define FBI_THREAD
#endif
static FBI_THREAD fb_detail fbi_detail = {FB_OK, "", "", -1, FB_R(0.0), FB_R(0.0), FB_R(0.0), -1};
static FBI_THREAD const char *fbi_entered = "";

FB_DEF const fb_detail *fb_detail_last(void)
{
  return &fbi_detail;
}

static int fbi_is_public(const char *function)
{
  return function[2] == '_'; /* fb_, not fbi_ */
}

/* `status` as it is written: functions that return another thing are not entered. */
static void fbi_detail_enter(const char *status, const char *function)
{
  fbi_entered = fbi_is_public(function) && strncmp(status, "FB_ERR_", 7) == 0 ? function : fbi_entered;
}

static FBI_NOINLINE fb_status fbi_refuse(fb_status status, const char *function, const char *what, int index,
                                         fb_real have, fb_real need, fb_real at)
{
  fbi_detail.status = status;
  fbi_detail.function = fbi_is_public(function) ? function : fbi_entered;
  fbi_detail.what = what;
  fbi_detail.index = index;
  fbi_detail.have = have;
  fbi_detail.need = need;
  fbi_detail.at = at;
  fbi_detail.part = -1;
  return status;
}

/* A condition of FBI_REQUIRE that does not hold; its status by name, none where the function returns another thing. */
#define FBI_STATUS_ENTRY(name, value, text) {name, #name},
static void fbi_detail_require(const char *status, const char *function, const char *condition)
{
  static const struct {
    fb_status status;
    const char *name;
  } list[] = {FB_STATUS_LIST(FBI_STATUS_ENTRY)};
  for (int i = 0; i < (int)(sizeof list / sizeof *list); i++) {
    if (strcmp(list[i].name, status) == 0) {
      (void)fbi_refuse(list[i].status, function, condition, -1, FB_R(0.0), FB_R(0.0), FB_R(0.0));
    }
  }
}
#undef FBI_STATUS_ENTRY
/* FBI_DETAIL_INDEX, FBI_DETAIL_PART: the number of the body, of the part that an inner check does not know. */
#define FBI_REFUSE_AT(status, what, index, have, need, at) fbi_refuse(status, __func__, what, index, have, need, at)
#define FBI_DETAIL_INDEX(status, i) fbi_detail.index = (status) != FB_OK ? (i) : fbi_detail.index
#define FBI_DETAIL_PART(k) fbi_detail.part = (k)
#else
#define FBI_REFUSE_AT(status, what, index, have, need, at) (status)
#define FBI_DETAIL_INDEX(status, i) ((void)0)
#define FBI_DETAIL_PART(k) ((void)0)
#endif
#define FBI_REFUSE(status, what, index, have, need) FBI_REFUSE_AT(status, what, index, have, need, FB_R(0.0))

/* Every public function that takes a pointer begins with one. With FB_WITH_DETAIL it tells whose refusals follow; those
   that others call on the way, the solvers, have FBI_REQUIRE_INNER. Both hand on their arguments as they are written:
   in FBI_REQUIRE_AS they are expanded. */
#if FB_WITH_DETAIL
#define FBI_DETAIL_ENTER(status) fbi_detail_enter(status, __func__)
#define FBI_DETAIL_REQUIRE(status, condition) fbi_detail_require(status, __func__, condition)
#define FBI_ENTERED(call) (fbi_detail_enter("FB_ERR_NULL", __func__), (call)) /* where a check of others is the first */
#else
#define FBI_ENTERED(call) (call)
#define FBI_DETAIL_ENTER(status) ((void)0)
#define FBI_DETAIL_REQUIRE(status, condition) ((void)0)
#endif
#define FBI_REQUIRE_AS(condition, status, condition_text, status_text) \
  do {                                                                 \
    if (!(condition)) {                                                \
      FBI_DETAIL_REQUIRE(status_text, condition_text);                 \
      FB_ASSERT(0);                                                    \
      return status;                                                   \
    }                                                                  \
  } while (0)
#define FBI_REQUIRE_INNER(condition, status) FBI_REQUIRE_AS(condition, status, #condition, #status)
#define FBI_REQUIRE(condition, status)                      \
  do {                                                      \
    FBI_DETAIL_ENTER(#status);                              \
    FBI_REQUIRE_AS(condition, status, #condition, #status); \
  } while (0)

/* 1 if sum |x[i]| <= FB_HUGE: x and its squares are finite; 0 for NaN. */
static int fbi_is_finite(const fb_real *x, int n)
{
  fb_real sum = FB_R(0.0);
  for (int i = 0; i < n; i++) {
    sum += FB_FABS(x[i]);
  }
  return sum <= FB_HUGE;
}

/* 1 if sums are evaluated in the order written and NaN differs from itself: detects fast-math flags without a macro. */
static int fbi_is_exact(void)
{
  volatile fb_real one = FB_R(1.0), little = FB_R(1e-30), x;
  fb_real a, b;
  memset(&a, 255, sizeof a); /* a quiet NaN, made without an operation that could trap */
  x = a;
  a = one;
  b = little;
  if (!((a + b) - a <= FB_R(0.0))) { /* zero by rounding in any precision; b if reordered */
    return 0;
  }
  a = x;
  return a != a; /* NOLINT: NaN */
}

#ifdef FB_ALLOW_FAST_MATH
#define FBI_REQUIRE_EXACT() ((void)0)
#else
#define FBI_REQUIRE_EXACT() FBI_REQUIRE(fbi_is_exact(), FB_ERR_BUILD)
#endif

#if FB_WITH_BUILD
/* Checks as tables: each entry with what is wrong if it does not hold, kept with FB_WITH_DETAIL alone. index: that of
   the station, joint, ... that the table is of. */
#if FB_WITH_DETAIL
#define FBI_WHAT const char *what;
#define FBI_NUMBER(x, n, least, most, what) \
  {                                         \
    x, n, least, most, what                 \
  }
#define FBI_COUNT(have, least, most, what) \
  {                                        \
    have, least, most, what                \
  }
#define FBI_CLAIM(holds, what) \
  {                            \
    holds, what                \
  }
#else
#define FBI_WHAT
#define FBI_NUMBER(x, n, least, most, what) \
  {                                         \
    x, n, least, most                       \
  }
#define FBI_COUNT(have, least, most, what) \
  {                                        \
    have, least, most                      \
  }
#define FBI_CLAIM(holds, what) \
  {                            \
    holds                      \
  }
#endif
#define FBI_ANY(x, n, what) FBI_NUMBER(x, n, -FB_HUGE, FB_HUGE, what ", finite")
#define FBI_NOT_NEGATIVE(x, n, what) FBI_NUMBER(x, n, FB_R(0.0), FB_HUGE, what ", at least")
#define FBI_AT_LEAST(have, least, what) FBI_COUNT(have, least, have, what ", at least")
#define FBI_AT_MOST(have, most, what) FBI_COUNT(have, have, most, what ", at most")
#define FBI_LENGTH(table) ((int)(sizeof(table) / sizeof *(table)))

typedef struct fbi_number { /* n numbers between least and most */
  const fb_real *x;
  int n;
  fb_real least, most;
  FBI_WHAT
} fbi_number;

typedef struct fbi_count {
  int have, least, most;
  FBI_WHAT
} fbi_count;

typedef struct fbi_claim {
  int holds;
  FBI_WHAT
} fbi_claim;

/* FB_ERR_NOT_FINITE for any of the numbers, then FB_ERR_VALUE. */
static fb_status fbi_numbers_check(const fbi_number *field, int n, int index)
{
  (void)index;
  for (int k = 0; k < n; k++) {
    if (!fbi_is_finite(field[k].x, field[k].n)) {
      int i = 0;
      while (i < field[k].n - 1 && fbi_is_finite(field[k].x + i, 1)) {
        i++;
      }
      return FBI_REFUSE_AT(FB_ERR_NOT_FINITE, field[k].what, index, field[k].x[i],
                           field[k].least > -FB_HUGE ? field[k].least : FB_R(0.0), (fb_real)i);
    }
  }
  for (int k = 0; k < n; k++) {
    for (int i = 0; i < field[k].n; i++) {
      if (field[k].x[i] < field[k].least || field[k].x[i] > field[k].most) {
        return FBI_REFUSE_AT(FB_ERR_VALUE, field[k].what, index, field[k].x[i],
                             field[k].x[i] < field[k].least ? field[k].least : field[k].most, (fb_real)i);
      }
    }
  }
  return FB_OK;
}

/* The status is that of a count out of its range. */
static fb_status fbi_counts_check(fb_status status, const fbi_count *count, int n, int index)
{
  (void)index;
  for (int k = 0; k < n; k++) {
    if (count[k].have < count[k].least || count[k].have > count[k].most) {
      return FBI_REFUSE(status, count[k].what, index, (fb_real)count[k].have,
                        (fb_real)(count[k].have < count[k].least ? count[k].least : count[k].most));
    }
  }
  return FB_OK;
}

/* FB_ERR_VALUE: a claim does not hold. */
static fb_status fbi_claims_check(const fbi_claim *claim, int n, int index)
{
  (void)index;
  for (int k = 0; k < n; k++) {
    if (!claim[k].holds) {
      return FBI_REFUSE(FB_ERR_VALUE, claim[k].what, index, FB_R(0.0), FB_R(0.0));
    }
  }
  return FB_OK;
}
#endif

static void fbi_zero(fb_real *x, int n)
{
  for (int i = 0; i < n; i++) {
    x[i] = FB_R(0.0);
  }
}

static void fbi_copy(fb_real *y, const fb_real *x, int n)
{
  for (int i = 0; i < n; i++) {
    y[i] = x[i];
  }
}

/* 1 if an enumerator is one of 0 .. last. A function, because compilers for ARM make small enums unsigned and would
   warn of value >= 0. */
static int fbi_is_choice(int value, int last)
{
  return value >= 0 && value <= last;
}

static int fbi_is_zero(const fb_real *x, int n)
{
  for (int i = 0; i < n; i++) {
    if (!(x[i] == FB_R(0.0))) { /* NaN is not zero */
      return 0;
    }
  }
  return 1;
}

#if FB_WITH_SYSTEM || FB_WITH_ANALYSE
static fb_real fbi_smaller(fb_real a, fb_real b)
{
  return a < b ? a : b;
}
#endif

static fb_real fbi_larger(fb_real a, fb_real b)
{
  return a > b ? a : b;
}

/* ---------------------------------------------------------------------------------------------------------------
   RUN >>vec3: 3-vectors, 3x3 and symmetric 6x6 matrices (uses config, status) */

FB_DEF fb_real fb_vec3_dot(const fb_real a[3], const fb_real b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

FB_DEF void fb_vec3_cross(fb_real c[3], const fb_real a[3], const fb_real b[3])
{
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

FB_DEF void fb_mat33_mul_vec3(fb_real y[3], const fb_real A[9], const fb_real x[3])
{
  y[0] = A[0] * x[0] + A[1] * x[1] + A[2] * x[2];
  y[1] = A[3] * x[0] + A[4] * x[1] + A[5] * x[2];
  y[2] = A[6] * x[0] + A[7] * x[1] + A[8] * x[2];
}

FB_DEF void fb_mat33_mulT_vec3(fb_real y[3], const fb_real A[9], const fb_real x[3])
{
  const fb_real a = A[0] * x[0] + A[3] * x[1] + A[6] * x[2];
  const fb_real b = A[1] * x[0] + A[4] * x[1] + A[7] * x[2];
  const fb_real c = A[2] * x[0] + A[5] * x[1] + A[8] * x[2];
  y[0] = a;
  y[1] = b;
  y[2] = c;
}

FB_DEF void fb_mat33_mul(fb_real C[9], const fb_real A[9], const fb_real B[9])
{
  const fb_real *a = A;
  FBI_UNROLL
  for (fb_real *c = C; c < C + 9; c += 3, a += 3) {
    const fb_real x = a[0] * B[0] + a[1] * B[3] + a[2] * B[6];
    const fb_real y = a[0] * B[1] + a[1] * B[4] + a[2] * B[7];
    const fb_real z = a[0] * B[2] + a[1] * B[5] + a[2] * B[8];
    c[0] = x;
    c[1] = y;
    c[2] = z;
  }
}

/* y = x, a copy of constant size: -O2 does not unroll a loop */
static void fbi_vec3_copy(fb_real y[3], const fb_real x[3])
{
  memcpy(y, x, 3 * sizeof *y);
}

static void fbi_vec3_zero(fb_real y[3])
{
  y[0] = y[1] = y[2] = FB_R(0.0);
}

#if FB_WITH_SYSTEM
static void fbi_mat33_copy(fb_real C[9], const fb_real A[9])
{
  fbi_vec3_copy(C, A);
  fbi_vec3_copy(C + 3, A + 3);
  fbi_vec3_copy(C + 6, A + 6);
}
#endif

/* y = x + s d; y may be x. All reads precede all writes, so that compilers can vectorize. */
static void fbi_vec3_advance(fb_real y[3], const fb_real x[3], fb_real s, const fb_real d[3])
{
  const fb_real a = x[0] + s * d[0], b = x[1] + s * d[1], c = x[2] + s * d[2];
  y[0] = a;
  y[1] = b;
  y[2] = c;
}

static void fbi_vec4_advance(fb_real y[4], const fb_real x[4], fb_real s, const fb_real rate[4])
{
  const fb_real a = x[0] + s * rate[0], b = x[1] + s * rate[1], c = x[2] + s * rate[2], d = x[3] + s * rate[3];
  y[0] = a;
  y[1] = b;
  y[2] = c;
  y[3] = d;
}

/* y += s x */
static void fbi_vec3_add(fb_real y[3], fb_real s, const fb_real x[3])
{
  fbi_vec3_advance(y, y, s, x);
}

/* y += a x b */
static void fbi_vec3_add_cross(fb_real y[3], const fb_real a[3], const fb_real b[3])
{
  y[0] += a[1] * b[2] - a[2] * b[1];
  y[1] += a[2] * b[0] - a[0] * b[2];
  y[2] += a[0] * b[1] - a[1] * b[0];
}

static int fbi_vec3_is_finite(const fb_real x[3])
{
  return FB_FABS(x[0]) + FB_FABS(x[1]) + FB_FABS(x[2]) <= FB_HUGE;
}

static fb_real fbi_vec3_norm(const fb_real a[3])
{
  return FB_SQRT(fb_vec3_dot(a, a));
}

static void fbi_vec6_zero(fb_real y[6])
{
  y[0] = y[1] = y[2] = y[3] = y[4] = y[5] = FB_R(0.0);
}

/* y = x, written out: -O2 does not unroll a loop */
static void fbi_vec6_copy(fb_real y[6], const fb_real x[6])
{
  const fb_real a = x[0], b = x[1], c = x[2], d = x[3], e = x[4], f = x[5];
  y[0] = a;
  y[1] = b;
  y[2] = c;
  y[3] = d;
  y[4] = e;
  y[5] = f;
}

#if FB_WITH_SYSTEM || FB_WITH_EXACT
static void fbi_vec6_advance(fb_real y[6], const fb_real x[6], fb_real s, const fb_real rate[6])
{
  const fb_real a = x[0] + s * rate[0], b = x[1] + s * rate[1], c = x[2] + s * rate[2];
  const fb_real d = x[3] + s * rate[3], e = x[4] + s * rate[4], f = x[5] + s * rate[5];
  y[0] = a;
  y[1] = b;
  y[2] = c;
  y[3] = d;
  y[4] = e;
  y[5] = f;
}

static void fbi_vec6_add(fb_real y[6], fb_real s, const fb_real x[6])
{
  fbi_vec6_advance(y, y, s, x);
}
#endif

/* Index in the packed upper triangle, row by row: 0..5, 6..10, 11..14, 15..17, 18..19, 20. */
FB_DEF int fb_sym6_index(int i, int j)
{
  const int row = i < j ? i : j;
  const int col = i < j ? j : i;
  FBI_REQUIRE(row >= 0 && col < 6, 0);
  return row * (11 - row) / 2 + col;
}

FB_DEF void fb_sym6_mul_vec6(fb_real y[6], const fb_real S[21], const fb_real x[6])
{
  y[0] = S[0] * x[0] + S[1] * x[1] + S[2] * x[2] + S[3] * x[3] + S[4] * x[4] + S[5] * x[5];
  y[1] = S[1] * x[0] + S[6] * x[1] + S[7] * x[2] + S[8] * x[3] + S[9] * x[4] + S[10] * x[5];
  y[2] = S[2] * x[0] + S[7] * x[1] + S[11] * x[2] + S[12] * x[3] + S[13] * x[4] + S[14] * x[5];
  y[3] = S[3] * x[0] + S[8] * x[1] + S[12] * x[2] + S[15] * x[3] + S[16] * x[4] + S[17] * x[5];
  y[4] = S[4] * x[0] + S[9] * x[1] + S[13] * x[2] + S[16] * x[3] + S[18] * x[4] + S[19] * x[5];
  y[5] = S[5] * x[0] + S[10] * x[1] + S[14] * x[2] + S[17] * x[3] + S[19] * x[4] + S[20] * x[5];
}

#if FB_WITH_SYSTEM
static void fbi_sym6_copy(fb_real T[21], const fb_real S[21])
{
  fbi_vec6_copy(T, S);
  fbi_vec6_copy(T + 6, S + 6);
  fbi_vec6_copy(T + 12, S + 12);
  T[18] = S[18];
  T[19] = S[19];
  T[20] = S[20];
}

/* S -= s u u^T */
static void fbi_sym6_rank1_sub(fb_real S[21], fb_real s, const fb_real u[6])
{
  const fb_real v[6] = {s * u[0], s * u[1], s * u[2], s * u[3], s * u[4], s * u[5]};
  const fb_real x[6] = {u[0], u[1], u[2], u[3], u[4], u[5]};
  S[0] -= v[0] * x[0];
  S[1] -= v[0] * x[1];
  S[2] -= v[0] * x[2];
  S[3] -= v[0] * x[3];
  S[4] -= v[0] * x[4];
  S[5] -= v[0] * x[5];
  S[6] -= v[1] * x[1];
  S[7] -= v[1] * x[2];
  S[8] -= v[1] * x[3];
  S[9] -= v[1] * x[4];
  S[10] -= v[1] * x[5];
  S[11] -= v[2] * x[2];
  S[12] -= v[2] * x[3];
  S[13] -= v[2] * x[4];
  S[14] -= v[2] * x[5];
  S[15] -= v[3] * x[3];
  S[16] -= v[3] * x[4];
  S[17] -= v[3] * x[5];
  S[18] -= v[4] * x[4];
  S[19] -= v[4] * x[5];
  S[20] -= v[5] * x[5];
}
#endif

/* Row and column of each packed element. */
static const int fbi_sym6_row[21] = {0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 4, 4, 5};

static const int fbi_sym6_column[21] = {0, 1, 2, 3, 4, 5, 1, 2, 3, 4, 5, 2, 3, 4, 5, 3, 4, 5, 4, 5, 5};

static fb_real fbi_vec6_dot(const fb_real a[6], const fb_real b[6])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5];
}

/* A = L D L^T of the symmetric 3x3 (xx, xy, xz, yy, yz, zz), without square roots; L holds 1/D in place of its unit
   diagonal. Returns 0 unless each pivot exceeds tol * reference[k], the round-off of its summands. */
static int fbi_chol3_factor(fb_real L[6], const fb_real A[6], const fb_real reference[3], fb_real tol)
{
  fb_real d, c;

  /* first column */
  if (!(A[0] > tol * reference[0])) {
    return 0;
  }
  L[0] = FB_R(1.0) / A[0];
  L[1] = A[1] * L[0];
  L[2] = A[2] * L[0];

  /* second column */
  d = A[3] - L[1] * A[1];
  if (!(d > tol * reference[1])) {
    return 0;
  }
  L[3] = FB_R(1.0) / d;
  c = A[4] - L[1] * A[2];
  L[4] = c * L[3];

  /* last pivot */
  d = A[5] - L[2] * A[2] - L[4] * c;
  if (!(d > tol * reference[2])) {
    return 0;
  }
  L[5] = FB_R(1.0) / d;
  return 1;
}

/* x = L^-1 y */
static void fbi_chol3_forward(fb_real x[3], const fb_real L[6], const fb_real y[3])
{
  x[0] = y[0];
  x[1] = y[1] - L[1] * x[0];
  x[2] = y[2] - L[2] * x[0] - L[4] * x[1];
}

/* x = L^-T D^-1 y */
static void fbi_chol3_back(fb_real x[3], const fb_real L[6], const fb_real y[3])
{
  x[2] = y[2] * L[5];
  x[1] = y[1] * L[3] - L[4] * x[2];
  x[0] = y[0] * L[0] - L[1] * x[1] - L[2] * x[2];
}

/* y = D^-1 x */
static void fbi_chol3_scale(fb_real y[3], const fb_real L[6], const fb_real x[3])
{
  y[0] = x[0] * L[0];
  y[1] = x[1] * L[3];
  y[2] = x[2] * L[5];
}

/* [E3.1] Solves S x = y for a symmetric positive definite 6x6 by blocks of 3, written out without index arithmetic.
   S = [A B; B^T D], A = L E L^T, Z = L^-1 B, D - Z^T E^-1 Z = G H G^T.
   Source: [GV] 4.1, 4.2.  Shapes: S packed 21.  Cost: about 160 flops, 6 divisions.
   Fails: a pivot is not above tol * reference, the size of its summands.
   Test: sym6_solve_inverts_random_and_graded_matrices. */
static fb_status fbi_sym6_solve_above(fb_real x[6], const fb_real S[21], const fb_real y[6], const fb_real reference[6],
                                      fb_real tol)
{
  const fb_real A[6] = {S[0], S[1], S[2], S[6], S[7], S[11]};
  const fb_real b0[3] = {S[3], S[8], S[12]}, b1[3] = {S[4], S[9], S[13]}, b2[3] = {S[5], S[10], S[14]};
  fb_real L[6], G[6], D[6], z0[3], z1[3], z2[3], w0[3], w1[3], w2[3], s[3], t[3];

  /* A = L E L^T, Z = L^-1 B, W = E^-1 Z */
  if (!fbi_chol3_factor(L, A, reference, tol)) {
    return FB_ERR_SINGULAR;
  }
  fbi_chol3_forward(z0, L, b0);
  fbi_chol3_forward(z1, L, b1);
  fbi_chol3_forward(z2, L, b2);
  fbi_chol3_scale(w0, L, z0);
  fbi_chol3_scale(w1, L, z1);
  fbi_chol3_scale(w2, L, z2);

  /* Schur complement D - Z^T W = G H G^T */
  D[0] = S[15] - fb_vec3_dot(z0, w0);
  D[1] = S[16] - fb_vec3_dot(z0, w1);
  D[2] = S[17] - fb_vec3_dot(z0, w2);
  D[3] = S[18] - fb_vec3_dot(z1, w1);
  D[4] = S[19] - fb_vec3_dot(z1, w2);
  D[5] = S[20] - fb_vec3_dot(z2, w2);
  if (!fbi_chol3_factor(G, D, reference + 3, tol)) {
    return FB_ERR_SINGULAR;
  }

  /* forward substitution */
  fbi_chol3_forward(s, L, y);
  t[0] = y[3] - fb_vec3_dot(w0, s);
  t[1] = y[4] - fb_vec3_dot(w1, s);
  t[2] = y[5] - fb_vec3_dot(w2, s);
  fbi_chol3_forward(t, G, t);

  /* back substitution */
  fbi_chol3_back(x + 3, G, t);
  fbi_vec3_add(s, -x[3], z0);
  fbi_vec3_add(s, -x[4], z1);
  fbi_vec3_add(s, -x[5], z2);
  fbi_chol3_back(x, L, s);
  return FB_OK;
}

#if FB_WITH_SYSTEM || FB_WITH_BUILD
/* Reference sizes of the pivots of S in a round-off test: the largest mass and inertia of all axes, because rotations
   mix axes, plus mass and moment, the most that elimination has subtracted from S. */
static void fbi_sym6_reference(fb_real reference[6], const fb_real S[21], fb_real mass, fb_real moment)
{
  const fb_real most = mass + fbi_larger(S[0], fbi_larger(S[6], S[11]));
  const fb_real turn = moment + fbi_larger(S[15], fbi_larger(S[18], S[20]));
  for (int i = 0; i < 6; i++) {
    reference[i] = i < 3 ? most : turn;
  }
}

/* [E3.2] Is S positive definite beyond round-off in its rows first..5? Gaussian elimination with diagonal pivoting, the
   pivots relative to their reference. Without pivoting a small pivot amplifies the round-off of the others, and an axis
   without inertia passes in some attitudes.
   Source: [GV] 4.2.  Shapes: S packed 21.  Cost: 100 flops.  Fails: never.
   Test: rods_without_thickness_are_refused_in_every_attitude. */
static int fbi_sym6_stands_out(const fb_real S[21], int first, const fb_real reference[6], fb_real tol)
{
  fb_real A[36];
  int done[6] = {0};
  for (int i = 0; i < 36; i++) {
    A[i] = S[fb_sym6_index(i / 6, i % 6)];
  }

  /* eliminate; done: rows already eliminated */
  for (int k = first; k < 6; k++) {
    int at = first; /* row of the largest remaining pivot */
    for (int i = first; i < 6; i++) {
      if (!done[i] && (done[at] || A[7 * i] * reference[at] > A[7 * at] * reference[i])) {
        at = i;
      }
    }
    if (!(A[7 * at] > tol * reference[at])) {
      return 0;
    }

    /* A_ij -= A_ip A_pj / A_pp in the remaining rows */
    done[at] = 1;
    for (int i = first; i < 6; i++) {
      for (int j = first; j < 6; j++) {
        A[6 * i + j] -= done[i] || done[j] ? FB_R(0.0) : A[6 * i + at] / A[7 * at] * A[6 * at + j];
      }
    }
  }
  return 1;
}
#endif

/* Least admissible pivot in a step, relative to the diagonal element. */
#define FBI_PIVOT (8 * FB_EPSILON)
static fb_status fbi_sym6_solve(fb_real x[6], const fb_real S[21], const fb_real y[6])
{
  const fb_real reference[6] = {S[0], S[6], S[11], S[15], S[18], S[20]};
  return fbi_sym6_solve_above(x, S, y, reference, FBI_PIVOT);
}

FB_DEF fb_status fb_sym6_solve(fb_real x[6], const fb_real S[21], const fb_real y[6])
{
  fb_real out[6];
  fb_status status;
  FBI_REQUIRE_INNER(x && S && y, FB_ERR_NULL);
  status = fbi_sym6_solve(out, S, y);
  if (status == FB_OK && !fbi_is_finite(out, 6)) {
    status = FB_ERR_NOT_FINITE;
  }
  if (status == FB_OK) {
    fbi_copy(x, out, 6);
  }
  return status;
}

/* ---------------------------------------------------------------------------------------------------------------
   RUN >>rotation: unit quaternions, exponential and logarithm (uses config, status, vec3) */

FB_DEF void fb_quat_mul(fb_real r[4], const fb_real p[4], const fb_real q[4])
{
  r[0] = p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3];
  r[1] = p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2];
  r[2] = p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1];
  r[3] = p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0];
}

/* [E4.1] Rotation matrix of a quaternion of any nonzero length, x_I = R x_B.
   R = ((w^2 - u.u) 1 + 2 u u^T + 2 w u^) / |q|^2: orthogonal also at the stages of an integrator, whose quaternions are
   not unit, so that a rotated inertial frame gives the same motion up to round-off.
   Source: textbook.  Cost: 40 flops, a division.  Fails: q = 0.  Test: quaternion_and_matrix_rotate_alike. */
FB_DEF void fb_quat_to_mat33(fb_real R[9], const fb_real q[4])
{
  const fb_real two = FB_R(2.0) / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const fb_real x2 = two * q[1], y2 = two * q[2], z2 = two * q[3];
  const fb_real wx = q[0] * x2, wy = q[0] * y2, wz = q[0] * z2;
  const fb_real xx = q[1] * x2, xy = q[1] * y2, xz = q[1] * z2;
  const fb_real yy = q[2] * y2, yz = q[2] * z2, zz = q[3] * z2;
  R[0] = FB_R(1.0) - (yy + zz);
  R[1] = xy - wz;
  R[2] = xz + wy;
  R[3] = xy + wz;
  R[4] = FB_R(1.0) - (xx + zz);
  R[5] = yz - wx;
  R[6] = xz - wy;
  R[7] = yz + wx;
  R[8] = FB_R(1.0) - (xx + yy);
}

/* y = R(q) x without forming R. */
static void fbi_quat_turn(fb_real y[3], const fb_real q[4], const fb_real x[3])
{
  const fb_real two = FB_R(2.0) / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  fb_real t[3], turn[3];
  fb_vec3_cross(t, q + 1, x);
  fb_vec3_cross(turn, q + 1, t);
  y[0] = x[0] + two * (q[0] * t[0] + turn[0]);
  y[1] = x[1] + two * (q[0] * t[1] + turn[1]);
  y[2] = x[2] + two * (q[0] * t[2] + turn[2]);
}

/* [E4.4] Quaternion rate, q_dot = 1/2 q o (0, w), w in body axes.
   Source: textbook.  Cost: 23 flops.  Fails: never.  Test: node_kinematics_match_finite_differences. */
static void fbi_quat_rate(fb_real rate[4], const fb_real q[4], const fb_real w[3])
{
  const fb_real x = FB_R(0.5) * w[0], y = FB_R(0.5) * w[1], z = FB_R(0.5) * w[2];
  rate[0] = -(q[1] * x + q[2] * y + q[3] * z);
  rate[1] = q[0] * x + q[2] * z - q[3] * y;
  rate[2] = q[0] * y + q[3] * x - q[1] * z;
  rate[3] = q[0] * z + q[1] * y - q[2] * x;
}

/* [E4.2] Exponential: q = (cos(phi/2), s phi_vector), s = sin(phi/2)/phi; returns s. A zero angle becomes a tiny one.
   Source: textbook.  Cost: 15 flops, sin, cos, sqrt for every phi.  Fails: never.
   Test: exponential_and_logarithm_are_inverse. */
static fb_real fbi_quat_exp(fb_real q[4], const fb_real phi[3])
{
  const fb_real half = fbi_larger(FB_R(0.5) * fbi_vec3_norm(phi), FB_TINY);
  const fb_real s = FB_R(0.5) * FB_SIN(half) / half;
  q[0] = FB_COS(half);
  q[1] = s * phi[0];
  q[2] = s * phi[1];
  q[3] = s * phi[2];
  return s;
}

FB_DEF void fb_quat_from_rotvec(fb_real q[4], const fb_real phi[3])
{
  (void)fbi_quat_exp(q, phi);
}

/* [E4.3] Logarithm of q = (w, u), the shorter rotation: phi = 2 atan2(|u|, w) u/|u|, |phi| <= pi; returns |phi|/|u|.
   Source: textbook.  Cost: 20 flops, sqrt, atan2 for every q.  Fails: never.
   Test: exponential_and_logarithm_are_inverse. */
static fb_real fbi_quat_log(fb_real phi[3], const fb_real q[4])
{
  const fb_real sign = q[0] < FB_R(0.0) ? -FB_R(1.0) : FB_R(1.0);
  const fb_real u = fbi_larger(fbi_vec3_norm(q + 1), FB_TINY);
  const fb_real s = FB_R(2.0) * FB_ATAN2(u, sign * q[0]) / u;
  phi[0] = sign * s * q[1];
  phi[1] = sign * s * q[2];
  phi[2] = sign * s * q[3];
  return s;
}

FB_DEF void fb_quat_to_rotvec(fb_real phi[3], const fb_real q[4])
{
  (void)fbi_quat_log(phi, q);
}

#if FB_WITH_SYSTEM
/* [E4.5] Quaternion of a rotation matrix, from its largest component, so that no divisor is small; w >= 0.
   Source: S.W. Shepperd, Quaternion from rotation matrix, J. Guidance 1(3), 1978.  Cost: 25 flops, a square root.
   Fails: never.  Test: attitudes_come_back_as_they_were. */
static void fbi_quat_from_mat33(fb_real q[4], const fb_real R[9])
{
  const fb_real x = R[7] - R[5], y = R[2] - R[6], z = R[3] - R[1]; /* 4 w x, 4 w y, 4 w z */
  const fb_real yz = R[5] + R[7], xz = R[2] + R[6], xy = R[1] + R[3];
  const fb_real four[4][4] = {{FB_R(1.0) + R[0] + R[4] + R[8], x, y, z}, /* 4 q q^T */
                              {x, FB_R(1.0) + R[0] - R[4] - R[8], xy, xz},
                              {y, xy, FB_R(1.0) - R[0] + R[4] - R[8], yz},
                              {z, xz, yz, FB_R(1.0) - R[0] - R[4] + R[8]}};
  int k = 0;
  fb_real s;
  for (int i = 1; i < 4; i++) {
    k = four[i][i] > four[k][k] ? i : k;
  }
  s = (four[k][0] < FB_R(0.0) ? -FB_R(0.5) : FB_R(0.5)) / FB_SQRT(four[k][k]);
  for (int i = 0; i < 4; i++) {
    q[i] = s * four[k][i];
  }
}
#endif

/* Branch-free: x/t^2, or its Taylor series for t^2 < 0.01, where x cancels, so that the instruction count does not
   depend on the angle. */
static fb_real fbi_quotient(fb_real x, fb_real t2, fb_real series)
{
  const fb_real small = (fb_real)(t2 < FB_R(1e-2));
  return small * series + (FB_R(1.0) - small) * x / fbi_larger(t2, FB_R(1e-2));
}

/* [E4.6] SE(3) exponential, the pose at the end of a line with constant twist per length (a helix): r = V(k) e,
   rotation exp(k), x = (e, k).
   V(k) = 1 + b k^ + c k^2, b = (1 - cos t)/t^2 = 2 s^2, c = (t - sin t)/t^3 = (1 - 2 s w)/t^2, t = |k|.
   Source: textbook (screw motion).  Cost: 80 flops, sin, cos, sqrt for every k.  Fails: never.
   Test: twist_and_pose_are_inverse. */
FB_DEF void fb_pose_from_twist(fb_real r[3], fb_real quat[4], const fb_real x[6])
{
  const fb_real *const e = x, *const k = x + 3;
  const fb_real s = fbi_quat_exp(quat, k), t2 = fb_vec3_dot(k, k), b = FB_R(2.0) * s * s;
  const fb_real near2 = t2 < FB_R(1.0) ? t2 : FB_R(1.0); /* the series of larger t is not used */
  const fb_real series =                                 /* remainder t^8/39916800 */
      FB_R(1.0) / FB_R(6.0) - near2 / FB_R(120.0) * (FB_R(1.0) - near2 / FB_R(42.0) * (FB_R(1.0) - near2 / FB_R(72.0)));
  const fb_real c = fbi_quotient(FB_R(1.0) - FB_R(2.0) * s * quat[0], t2, series);
  fb_real ke[3], kke[3];
  fb_vec3_cross(ke, k, e);
  fb_vec3_cross(kke, k, ke);
  for (int i = 0; i < 3; i++) {
    r[i] = e[i] + b * ke[i] + c * kke[i];
  }
}

/* [E4.7] SE(3) logarithm, the inverse of E4.6: k = log quat, e = V(k)^-1 r = r - k x r / 2 + g k x (k x r),
   g = (1 - t/2 cot(t/2))/t^2, where t/2 cot(t/2) = t w/(2 |u|) of the quaternion (w, u).
   Source: textbook.  Cost: 60 flops, sqrt, atan2 for every quat.  Fails: never; |k| <= pi.
   Test: twist_and_pose_are_inverse. */
FB_DEF void fb_pose_to_twist(fb_real x[6], const fb_real r[3], const fb_real quat[4])
{
  const fb_real s = fbi_quat_log(x + 3, quat), t2 = fb_vec3_dot(x + 3, x + 3);
  const fb_real series =
      FB_R(1.0) / FB_R(12.0) + t2 / FB_R(720.0) * (FB_R(1.0) + t2 / FB_R(42.0) * (FB_R(1.0) + t2 / FB_R(40.0)));
  const fb_real g = fbi_quotient(FB_R(1.0) - FB_R(0.5) * s * FB_FABS(quat[0]), t2, series);
  fb_real kr[3], kkr[3];
  fb_vec3_cross(kr, x + 3, r);
  fb_vec3_cross(kkr, x + 3, kr);
  for (int i = 0; i < 3; i++) {
    x[i] = r[i] - FB_R(0.5) * kr[i] + g * kkr[i];
  }
}

/* [E4.8] Wiener-Milenkovic parameters, c = 4 tan(phi/4) along the axis = 4 u/(1 + w) of the quaternion (w, u).
   Of the equivalent rotations phi and phi - 2 pi the one up to pi is taken (w >= 0): |c| does not exceed 4, c changes
   sign at pi, and no rotation is singular.
   Source: [L] 3.4-3.6, 3.10-3.13.  Cost: 6 flops.  Fails: never.  Test: wiener_milenkovic_parameters_rescale. */
FB_DEF void fb_quat_to_wiener_milenkovic(fb_real c[3], const fb_real quat[4])
{
  const fb_real s = FB_R(4.0) / (FB_R(1.0) + FB_FABS(quat[0])) * (quat[0] < FB_R(0.0) ? -FB_R(1.0) : FB_R(1.0));
  c[0] = s * quat[1];
  c[1] = s * quat[2];
  c[2] = s * quat[3];
}

FB_DEF void fb_quat_from_wiener_milenkovic(fb_real quat[4], const fb_real c[3])
{
  const fb_real c2 = fb_vec3_dot(c, c), s = FB_R(8.0) / (FB_R(16.0) + c2);
  quat[0] = (FB_R(16.0) - c2) / (FB_R(16.0) + c2);
  quat[1] = s * c[0];
  quat[2] = s * c[1];
  quat[3] = s * c[2];
}

FB_DEF fb_status fb_quat_normalize(fb_real q[4])
{
  FBI_REQUIRE_INNER(q, FB_ERR_NULL);
  const fb_real norm2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  if (!(norm2 > FB_R(1e-20) && norm2 < FB_HUGE)) {
    return FB_ERR_VALUE;
  }
  {
    const fb_real s = FB_R(1.0) / FB_SQRT(norm2);
    q[0] *= s;
    q[1] *= s;
    q[2] *= s;
    q[3] *= s;
  }
  return FB_OK;
}

/* ---------------------------------------------------------------------------------------------------------------
   RUN >>solve: LU and Cholesky factors (uses config, status) */

/* y -= s x for rows that do not overlap; compilers vectorize the groups of four */
static void fbi_row_sub(fb_real *y, fb_real s, const fb_real *x, int n)
{
  int j = 0;
  FBI_UNROLL_2
  for (; j + 4 <= n; j += 4) {
    const fb_real a = y[j] - s * x[j], b = y[j + 1] - s * x[j + 1], c = y[j + 2] - s * x[j + 2],
                  d = y[j + 3] - s * x[j + 3];
    y[j] = a;
    y[j + 1] = b;
    y[j + 2] = c;
    y[j + 3] = d;
  }
  for (; j < n; j++) {
    y[j] -= s * x[j];
  }
}

/* x.y by four partial sums, which compilers vectorize */
static fb_real fbi_dot(const fb_real *x, const fb_real *y, int n)
{
  fb_real a = FB_R(0.0), b = FB_R(0.0), c = FB_R(0.0), d = FB_R(0.0);
  int j = 0;
  FBI_UNROLL_2
  for (; j + 4 <= n; j += 4) {
    a += x[j] * y[j];
    b += x[j + 1] * y[j + 1];
    c += x[j + 2] * y[j + 2];
    d += x[j + 3] * y[j + 3];
  }
  for (; j < n; j++) {
    a += x[j] * y[j];
  }
  return (a + b) + (c + d);
}

/* Dot product that adds the product of the newest unknown last: in forward substitution x[n-1] was computed just
   before, and the other products need not wait for it. */
static fb_real fbi_dot_new_last(const fb_real *x, const fb_real *y, int n)
{
  return n > 0 ? fbi_dot(x, y, n - 1) + x[n - 1] * y[n - 1] : FB_R(0.0);
}

/* The same for back substitution, where x[0] is the newest unknown. */
static fb_real fbi_dot_new_first(const fb_real *x, const fb_real *y, int n)
{
  return n > 0 ? fbi_dot(x + 1, y + 1, n - 1) + x[0] * y[0] : FB_R(0.0);
}

/* Exchanges x and y, which may be the same row. */
static void fbi_swap(fb_real *x, fb_real *y, int n)
{
  for (int i = 0; i < n; i++) {
    const fb_real was = x[i];
    x[i] = y[i];
    y[i] = was;
  }
}

/* [E5.1] LU with scaled partial pivoting, P A = L U.
   A pivot counts as zero when it is below n epsilon of its column's largest element, both taken relative to their rows'
   largest elements: neither row nor column scaling changes the result of the test.
   Source: [GV] 3.4.  Shapes: A n x n.  Cost: 2/3 n^3 flops.  Fails: singular, not finite.
   Test: lu_solves_random_graded_and_refuses_singular_matrices. */
FB_DEF fb_status fb_lu_factor(fb_real *A, int *perm, fb_real *scale, int n)
{
  FBI_REQUIRE_INNER(A && perm && scale, FB_ERR_NULL);
  FBI_REQUIRE_INNER(n >= 0, FB_ERR_VALUE);

  /* row scales */
  for (int i = 0; i < n; i++) {
    fb_real largest = FB_R(0.0);
    if (!fbi_is_finite(A + i * n, n)) {
      return FB_ERR_NOT_FINITE;
    }
    for (int j = 0; j < n; j++) {
      largest = fbi_larger(largest, FB_FABS(A[i * n + j]));
    }
    if (!(largest > FB_R(0.0))) {
      return FB_ERR_SINGULAR;
    }
    scale[i] = FB_R(1.0) / largest;
    perm[i] = i;
  }

  for (int k = 0; k < n; k++) {
    fb_real best = FB_R(0.0), column = FB_R(0.0), pivot;
    int row = k, p;

    /* pivot: largest scaled element of the column, from row k on */
    for (int i = 0; i < n; i++) { /* rows above k hold U, in place of the original column */
      const fb_real size = FB_FABS(A[i * n + k]) * scale[i];
      column = fbi_larger(column, size);
      row = i >= k && size > best ? i : row;
      best = i >= k ? fbi_larger(best, size) : best;
    }
    if (!(best > (fb_real)n * FB_EPSILON * column)) {
      return FB_ERR_SINGULAR;
    }

    /* row exchange */
    p = perm[k]; /* also for row == k: constant instruction count */
    perm[k] = perm[row];
    perm[row] = p;
    fbi_swap(scale + k, scale + row, 1);
    fbi_swap(A + k * n, A + row * n, n);

    /* column k of L; rows below: A_i -= L_ik U_k */
    pivot = FB_R(1.0) / A[k * n + k];
    for (int i = k + 1; i < n; i++) {
      const fb_real factor = A[i * n + k] * pivot;
      A[i * n + k] = factor;
      fbi_row_sub(A + i * n + k + 1, factor, A + k * n + k + 1, n - k - 1);
    }
  }
  return FB_OK;
}

FB_DEF void fb_lu_solve(fb_real *x, const fb_real *LU, const int *perm, const fb_real *b, int n)
{
  for (int i = 0; i < n; i++) {
    x[i] = b[perm[i]] - fbi_dot_new_last(x, LU + i * n, i);
  }
  for (int i = n - 1; i >= 0; i--) {
    const fb_real pivot = FB_R(1.0) / LU[i * n + i]; /* overlaps with the sum */
    x[i] = (x[i] - fbi_dot_new_first(x + i + 1, LU + i * n + i + 1, n - i - 1)) * pivot;
  }
}

#if FB_WITH_EXACT
/* X = A^-1 X for n x c right-hand sides, row-major; y: scratch of the same size. */
static void fbi_lu_solve_rows(fb_real *X, fb_real *y, const fb_real *LU, const int *perm, int n, int c)
{
  fbi_copy(y, X, n * c);
  for (int i = 0; i < n; i++) {
    fbi_copy(X + i * c, y + perm[i] * c, c);
    for (int k = 0; k < i; k++) {
      fbi_row_sub(X + i * c, LU[i * n + k], X + k * c, c);
    }
  }
  for (int i = n - 1; i >= 0; i--) {
    const fb_real pivot = FB_R(1.0) / LU[i * n + i];
    for (int k = i + 1; k < n; k++) {
      fbi_row_sub(X + i * c, LU[i * n + k], X + k * c, c);
    }
    for (int j = 0; j < c; j++) {
      X[i * c + j] *= pivot;
    }
  }
}
#endif

/* [E5.5] LU without pivoting, for matrices whose symmetric part is positive definite: element growth is then
   bounded. The diagonal holds the reciprocals of the pivots.
   Source: [GV] 4.3.2.  Shapes: A n x n.  Cost: 2/3 n^3 flops.  Fails: a pivot that is not positive.
   Test: each_integrator_converges_at_its_order. */
static fb_status fbi_lu_plain_factor(fb_real *A, int n)
{
  for (int k = 0; k < n; k++) {
    if (!(A[k * n + k] > FB_R(0.0)) || !fbi_is_finite(A + k * n + k, 1)) {
      return fbi_is_finite(A + k * n + k, 1) ? FB_ERR_SINGULAR : FB_ERR_NOT_FINITE;
    }
    A[k * n + k] = FB_R(1.0) / A[k * n + k];
    for (int i = k + 1; i < n; i++) {
      A[i * n + k] *= A[k * n + k];
      fbi_row_sub(A + i * n + k + 1, A[i * n + k], A + k * n + k + 1, n - k - 1);
    }
  }
  return FB_OK;
}

/* x = A^-1 x by the factors of E5.5 */
static void fbi_lu_plain_solve(fb_real *x, const fb_real *A, int n)
{
  for (int i = 1; i < n; i++) {
    x[i] -= fbi_dot_new_last(x, A + i * n, i);
  }
  for (int i = n - 1; i >= 0; i--) {
    x[i] = (x[i] - fbi_dot_new_first(x + i + 1, A + i * n + i + 1, n - i - 1)) * A[i * n + i];
  }
}

/* [E5.2] Cholesky, A = L L^T. A pivot counts as zero below n epsilon of its own diagonal element.
   Source: [GV] 4.2.  Shapes: A n x n, lower triangle used.  Cost: n^3/3 flops.  Fails: not positive definite.
   Test: cholesky_factors_graded_and_refuses_indefinite_matrices. */
FB_DEF fb_status fb_chol_factor(fb_real *A, int n)
{
  FBI_REQUIRE_INNER(A, FB_ERR_NULL);
  FBI_REQUIRE_INNER(n >= 0, FB_ERR_VALUE);
  for (int j = 0; j < n; j++) {
    const fb_real diagonal = A[j * n + j];
    const fb_real sum = diagonal - fbi_dot(A + j * n, A + j * n, j);
    if (!fbi_is_finite(&sum, 1)) {
      return FB_ERR_NOT_FINITE;
    }
    if (!(sum > (fb_real)n * FB_EPSILON * diagonal)) {
      return FB_ERR_SINGULAR;
    }
    A[j * n + j] = FB_SQRT(sum);
    for (int i = j + 1; i < n; i++) {
      A[i * n + j] = (A[i * n + j] - fbi_dot(A + i * n, A + j * n, j)) / A[j * n + j];
    }
  }
  return FB_OK;
}

/* x = L^-1 b; x may be b */
static void fbi_chol_forward(fb_real *x, const fb_real *L, const fb_real *b, int n)
{
  for (int i = 0; i < n; i++) {
    fb_real sum = b[i];
    for (int j = 0; j < i; j++) {
      sum -= L[i * n + j] * x[j];
    }
    x[i] = sum / L[i * n + i];
  }
}

/* x = L^-T b; x may be b */
static void fbi_chol_back(fb_real *x, const fb_real *L, const fb_real *b, int n)
{
  for (int i = n - 1; i >= 0; i--) {
    fb_real sum = b[i];
    for (int j = i + 1; j < n; j++) {
      sum -= L[j * n + i] * x[j];
    }
    x[i] = sum / L[i * n + i];
  }
}

FB_DEF void fb_chol_solve(fb_real *x, const fb_real *L, const fb_real *b, int n)
{
  fbi_chol_forward(x, L, b, n);
  fbi_chol_back(x, L, x, n);
}

/* ---------------------------------------------------------------------------------------------------------------
   RUN >>body: one body in a floating frame: rates, motion, nodes, sensors, energy, checks
   (uses config, status, vec3, rotation, solve) */

FB_DEF fb_real fb_gauge_eval(const fb_gauge *gauge, const fb_real *q)
{
  FBI_REQUIRE(gauge && q && gauge->n >= 0 && gauge->n <= FB_MAX_MODES, FB_R(0.0));
  return fbi_dot(gauge->gain, q, gauge->n);
}

/* ---- effects, sparse matrices, the base */

#define FBI_EFFECTS_BUILT                                                                  \
  (FB_EFFECT_ELASTIC | (FB_WITH_SPIN_COUPLING ? FB_EFFECT_SPIN_COUPLING : 0) |             \
   (FB_WITH_RESIDUAL_INERTIA ? FB_EFFECT_RESIDUAL_INERTIA : 0) |                           \
   (FB_WITH_SPIN_STIFFENING ? FB_EFFECT_SPIN_STIFFENING : 0) |                             \
   (FB_WITH_ACCELERATION_STIFFENING ? FB_EFFECT_ACCELERATION_STIFFENING : 0) |             \
   (FB_WITH_DAMPING ? FB_EFFECT_DAMPING : 0) | (FB_WITH_GRAVITY ? FB_EFFECT_GRAVITY : 0) | \
   (FB_WITH_NONLINEAR_STRAIN ? FB_EFFECT_NONLINEAR_STRAIN : 0))
#define FBI_QUADRATIC_EFFECTS (FB_EFFECT_SPIN_STIFFENING | FB_EFFECT_ACCELERATION_STIFFENING)
/* 1 if one of these effects is on; a compile-time 0 where they were removed. */
static int fbi_has(unsigned effects, int effect)
{
  return (effects & (unsigned)effect & (unsigned)FBI_EFFECTS_BUILT) != 0;
}

/* 1 if an effect was removed at compile time, or foreshortening would be counted twice: by the nonlinear strain and by
   the second-order displacement field. */
static int fbi_is_excluded(unsigned effects)
{
  return (effects & ~(unsigned)FBI_EFFECTS_BUILT) ||
         ((effects & FB_EFFECT_NONLINEAR_STRAIN) && (effects & FBI_QUADRATIC_EFFECTS));
}

#define FBI_WORD_EXCLUDED \
  "effects: all compiled in (FB_WITH_..), nonlinear strain without spin and acceleration stiffening"
FB_DEF fb_status fb_effects_check(unsigned effects)
{
  if (fbi_is_excluded(effects)) {
    return FBI_REFUSE(FB_ERR_EFFECTS, FBI_WORD_EXCLUDED, -1, FB_R(0.0), FB_R(0.0));
  }
  if ((effects & FB_EFFECT_RESIDUAL_INERTIA) &&
      (!(effects & FB_EFFECT_SPIN_COUPLING) || !(effects & (FB_EFFECT_SPIN_STIFFENING | FB_EFFECT_NONLINEAR_STRAIN)))) {
    return FBI_REFUSE(FB_ERR_EFFECTS, "effects: residual inertia, with spin coupling and a stiffening", -1, FB_R(0.0),
                      FB_R(0.0));
  }
  return FB_OK;
}

static void fbi_sparse_add(fb_real *A, fb_real s, const fb_sparse *sparse, int n)
{
  for (int a = 0; a < n; a++) {
    A[a * (n + 1)] += s * sparse->diagonal[a];
  }
  for (int k = 0; k < sparse->n_term; k++) {
    const fb_pair_term *t = &sparse->term[k];
    A[t->a * n + t->b] += s * t->c;
    A[t->b * n + t->a] += s * t->c;
  }
}

static void fbi_sparse_to_dense(fb_real *A, const fb_sparse *sparse, int n)
{
  fbi_zero(A, n * n);
  fbi_sparse_add(A, FB_R(1.0), sparse, n);
}

/* Of a vector g in body axes, drops the components about which a hinged base cannot rotate: all but z. */
static void fbi_turning_part(fb_real g[3], fb_base base)
{
  if (base == FB_BASE_HINGED) {
    g[0] = g[1] = FB_R(0.0);
  }
}

static int fbi_holds_origin(fb_base base)
{
  return base == FB_BASE_PINNED || base == FB_BASE_HINGED;
}

/* First of the six rigid-body rows (v, w) that the base leaves free; 6 if none. */
static int fbi_first_free(fb_base base)
{
  return base == FB_BASE_FREE ? 0 : base == FB_BASE_PINNED ? 3 : base == FB_BASE_HINGED ? 5 : 6;
}

/* [E8.22] Solves S x = y in the rows that the base leaves free, with x = 0 in the others: all of V (free), w (pinned),
   w_z (hinged), none (prescribed).
   Source: rows of E8.13 whose reactions are zero.  Shapes: S packed 21.  Cost: at most 150 flops.
   Fails: not positive definite.  Test: pinned_and_hinged_bodies_swing_as_rigid_pendulums. */
static fb_status fbi_base_solve(fb_real x[6], fb_base base, const fb_real S[21], const fb_real y[6])
{
  if (base == FB_BASE_FREE) {
    return fbi_sym6_solve(x, S, y);
  }

  /* pinned: the 3x3 block of w */
  for (int i = 0; i < 6; i++) {
    x[i] = i >= 3 ? y[i] : FB_R(0.0);
  }
  if (base == FB_BASE_PINNED) {
    const fb_real reference[3] = {S[15], S[18], S[20]};
    fb_real L[6];
    if (!fbi_chol3_factor(L, S + 15, reference, FBI_PIVOT)) {
      return FB_ERR_SINGULAR;
    }
    fbi_chol3_forward(x + 3, L, x + 3);
    fbi_chol3_back(x + 3, L, x + 3);
    return FB_OK;
  }

  /* prescribed, hinged */
  x[3] = x[4] = FB_R(0.0);
  if (base == FB_BASE_PRESCRIBED) {
    x[5] = FB_R(0.0);
    return FB_OK;
  }
  x[5] = y[5] / S[20];
  return S[20] > FB_R(0.0) ? FB_OK : FB_ERR_SINGULAR;
}

static int fbi_node_is_finite(const fb_node *node, int n)
{
  const int own = fbi_is_finite(node->r, 3) && fbi_is_finite(node->psi, 3 * n) && fbi_is_finite(node->theta, 3 * n);
#if FBI_WITH_QUADRATIC
  return own && fbi_is_finite(node->chi, 3 * n * (n + 1) / 2) && fbi_is_finite(node->chi_theta, 3 * n * (n + 1) / 2);
#else
  return own;
#endif
}

/* ---- kernels of the step */

/* y = f + s A x for a symmetric sparse A; f NULL: zero; y may be f, not x */
static void fbi_sparse_eval(fb_real *y, const fb_real *f, fb_real s, const fb_sparse *A, const fb_real *x, int n)
{
  const fb_pair_term *t = A->term;
  for (int a = 0; a < n && f; a++) {
    y[a] = f[a] + s * A->diagonal[a] * x[a];
  }
  for (int a = 0; a < n && !f; a++) {
    y[a] = s * A->diagonal[a] * x[a];
  }
  for (const fb_pair_term *end = t + A->n_term; t < end; t++) {
    y[t->a] += s * t->c * x[t->b];
    y[t->b] += s * t->c * x[t->a];
  }
}

/* Form of the equations of motion; the constant 0, momentum (Hamiltonian) form, where no other is compiled. */
static int fbi_form(const fb_body *body)
{
#if FB_WITH_FORMS
  return (int)body->form;
#else
  (void)body;
  return 0;
#endif
}

/* y = M^-1 x; mass-normalized modes: a copy */
static void fbi_mass_solve(fb_real *y, const fb_body *body, const fb_real *x)
{
  if (body->unit_mass) {
    fbi_copy(y, x, body->n);
    return;
  }
  fbi_sparse_eval(y, NULL, FB_R(1.0), &body->Minv, x, body->n);
}

/* y = M x */
static void fbi_mass_mul(fb_real *y, const fb_body *body, const fb_real *x)
{
  if (body->unit_mass) {
    fbi_copy(y, x, body->n);
    return;
  }
  fbi_sparse_eval(y, NULL, FB_R(1.0), &body->M, x, body->n);
}

/* y -= sum_a q_a Lambda_a pb, the part of E8.9 that is linear in q; qx = (1, q). By rows: sums stay in registers. */
static void fbi_lambda_linear_sub(fb_real y[6], const fb_body *body, const fb_real *qx, const fb_real *pb)
{
  const fb_lambda_term *t = body->lambda + body->n_lambda_constant;
  for (const fb_lambda_row *r = body->lambda_row; r < body->lambda_row + body->n_row; r++) {
    fb_real sum = y[r->i];
    for (const fb_lambda_term *end = body->lambda + r->end; t < end; t++) {
      sum += t->c * qx[t->a] * pb[t->b];
    }
    y[r->i] = sum;
  }
}

/* [E8.9] y -= Lambda(q) pb, the contribution of the modes to the momenta (p, h).
   Source: THEORY.md 8.2.  Cost: 3 n_lambda flops.  Test: momenta_agree_with_a_particle_model. */
static void fbi_lambda_sub(fb_real y[6], const fb_body *body, const fb_real *qx, const fb_real *pb)
{
  const fb_lambda_term *t = body->lambda;
  FBI_UNROLL
  for (int k = body->n_lambda_constant; k > 0; k--, t++) {
    y[t->i] += t->c * pb[t->b];
  }
  fbi_lambda_linear_sub(y, body, qx, pb);
}

/* e -= sum_a q_a Lambda_a^T V, x += d/dq (V^T Lambda(q) pb): the part of E8.10 that is linear in q. */
static void fbi_lambda_linear_gradients(fb_real *e, fb_real *x, const fb_body *body, const fb_real V[6],
                                        const fb_real *qx, const fb_real *pb)
{
  const fb_lambda_term *t = body->lambda + body->n_lambda_constant;
  for (const fb_lambda_row *r = body->lambda_row; r < body->lambda_row + body->n_row; r++) {
    const fb_real along = V[r->i];
    for (const fb_lambda_term *end = body->lambda + r->end; t < end; t++) {
      const fb_real s = t->c * along;
      e[t->b] += s * qx[t->a];
      x[t->a] -= s * pb[t->b];
    }
  }
}

/* [E8.10] Gradients of the trilinear form V^T Lambda(q) pb: e -= Lambda(q)^T V (elastic velocities),
   x += d/dq (V^T Lambda pb) (elastic forces: gyroscopic (Coriolis), E8.4); x is indexed as (1, q), x[0] is not written.
   Source: THEORY.md 8.2; -N(w)^T pi_e.  Cost: 5 n_lambda flops.  Test: accelerations_agree_with_a_particle_model. */
static void fbi_lambda_gradients(fb_real *e, fb_real *x, const fb_body *body, const fb_real V[6], const fb_real *qx,
                                 const fb_real *pb)
{
  const fb_lambda_term *t = body->lambda;
  FBI_UNROLL
  for (int k = body->n_lambda_constant; k > 0; k--, t++) {
    e[t->b] += t->c * V[t->i];
  }
  fbi_lambda_linear_gradients(e, x, body, V, qx, pb);
}

/* S += its first n runs with the monomials m of the pairs; a run: consecutive pairs of one element of S.
   Cost: 2 n_S flops. */
static void fbi_S_add(fb_real S[21], const fb_body *body, const fb_real *m, int n)
{
  const fb_real *c = body->S;
  for (const fb_S_run *r = body->run; r < body->run + n; r++) {
    S[r->i] += fbi_dot(c, m + r->pair, r->n);
    c += r->n;
  }
}

/* [E8.11] Reduced rigid-body inertia S(q) from the monomials (1,q)_a (1,q)_b and its first n runs: fewer than all only
   in a truncated second-order form.
   Source: E8.6.  Cost: 2 n_S + n_pair flops.  Test: momenta_agree_with_a_particle_model. */
static void fbi_S_eval(fb_real S[21], const fb_body *body, const fb_real *qx, int n)
{
  fb_real m[FBI_MAX_PAIRS_S + 3]; /* padded to groups of four: with one mode gcc warns otherwise */
  const fb_S_pair *const last = body->pair + body->n_pair;
  fb_real *to = m;
  FBI_UNROLL_2
  for (const fb_S_pair *p = body->pair; p < last; p++, to++) {
    *to = qx[p->a] * qx[p->b];
  }
  for (int i = 0; i < 21; i++) {
    S[i] = body->S0[i];
  }
  fbi_S_add(S, body, m, n);
}

/* dS = rate of S(q) for the rate xd of (1, q). */
static void fbi_S_rate(fb_real dS[21], const fb_body *body, const fb_real *qx, const fb_real *xd)
{
  fb_real m[FBI_MAX_PAIRS_S + 3]; /* padded to groups of four: with one mode gcc warns otherwise */
  for (int k = 0; k < body->n_pair; k++) {
    const int a = body->pair[k].a, b = body->pair[k].b;
    m[k] = qx[a] * xd[b] + xd[a] * qx[b];
  }
  fbi_zero(dS, 21);
  fbi_S_add(dS, body, m, body->n_run);
}

#if FBI_WITH_SHAPE_INERTIA
/* [E8.12] x += d/d(1,q) (1/2 V^T S V): centrifugal softening and stiffening.
   Source: THEORY.md 8.2.  Cost: 2 n_S + 4 n_pair flops.
   Test: accelerations_agree_with_a_particle_model. */
static void fbi_S_gradient(fb_real *x, const fb_body *body, const fb_real V[6], const fb_real *qx)
{
  const fb_real *c = body->S;
  fb_real g[FBI_MAX_PAIRS_S + 3];
  fbi_zero(g, body->n_pair);
  for (const fb_S_run *r = body->run; r < body->run + body->n_run; r++) {
    const int i = fbi_sym6_row[r->i], j = fbi_sym6_column[r->i];
    fbi_row_sub(g + r->pair, (i == j ? FB_R(-0.5) : FB_R(-1.0)) * V[i] * V[j], c, r->n);
    c += r->n;
  }
  const fb_real *s = g;
  const fb_S_pair *const last = body->pair + body->n_pair;
  FBI_UNROLL_2
  for (const fb_S_pair *p = body->pair; p < last; p++, s++) {
    const int a = p->a, b = p->b;
    x[a] += *s * qx[b];
    x[b] += *s * qx[a];
  }
}
#endif

/* X = rows first..5 of Lambda(q), (6 - first) x n, from the first n_terms of its list. */
static void fbi_lambda_rows(fb_real *X, const fb_body *body, const fb_real *qx, int first, int n_terms)
{
  fbi_zero(X, (6 - first) * body->n);
  for (int t = 0; t < n_terms; t++) {
    const fb_lambda_term *term = &body->lambda[t];
    if (term->i >= first) {
      X[(term->i - first) * body->n + term->b] -= term->c * qx[term->a];
    }
  }
}

#if FB_WITH_NONLINEAR_STRAIN
/* Slopes u_x', u_y', u_z' at the strain stations (quadrature points). */
static void fbi_slopes_eval(fb_real slope[3][FBI_MAX_STRAINS], const fb_body *body, const fb_real *q)
{
  const fb_strain_row *row = body->strain_row;
  for (int i = 0; i < 3; i++) {
    for (int g = 0; g < body->n_strain; g++) {
      slope[i][g] = FB_R(0.0);
    }
  }
  for (const fb_strain_row *end = row + body->n_strain_row; row < end; row++) {
    fbi_row_sub(slope[row->axis], -q[row->a], row->slope, body->n_strain);
  }
}

/* x_a -= sum over the stations of the slopes of mode a times f, per axis */
static void fbi_slopes_sub(fb_real *x, const fb_body *body, fb_real f[3][FBI_MAX_STRAINS])
{
  const fb_strain_row *row = body->strain_row;
  for (const fb_strain_row *end = row + body->n_strain_row; row < end; row++) {
    x[row->a] -= fbi_dot(row->slope, f[row->axis], body->n_strain);
  }
}

/* [E8.23] Generalized forces of the nonlinear axial strain e = u_x' + 1/2 (u_y'^2 + u_z'^2), x -= dU/dq without K q,
   dU/dq_a = int EA e (psi_x,a' + u_y' psi_y,a' + u_z' psi_z,a') dx, by quadrature over the strain stations instead of
   third- and fourth-order stiffness tensors: 2 sums over the stations per coordinate. quartic = 0 instead of 1 omits
   the part of U of degree 4.
   Source: [DB] (27), (29)-(31) with ERRATA.md DB5 to DB10.  Shapes: x n.  Cost: (4 n + 12) stations.  Fails: never.
   Test: strain_forces_are_the_gradient_of_the_energy, spin_up_follows_the_references_of_each_form. */
static FBI_NOINLINE void fbi_strain_sub(fb_real *x, fb_real slope[3][FBI_MAX_STRAINS], const fb_body *body,
                                        const fb_real *q, fb_real quartic)
{
  fb_real f[3][FBI_MAX_STRAINS];
  fbi_slopes_eval(slope, body, q);
  for (int g = 0; g < body->n_strain; g++) {
    const fb_real y = slope[1][g], z = slope[2][g], EA = body->strain_weight[g];
    const fb_real half = FB_R(0.5) * (y * y + z * z);
    const fb_real tension = EA * (slope[0][g] + quartic * half);
    f[0][g] = EA * half;
    f[1][g] = tension * y;
    f[2][g] = tension * z;
  }
  fbi_slopes_sub(x, body, f);
}

/* t_j = x_j y_j; n is a multiple of four */
static void fbi_products(fb_real *t, const fb_real *x, const fb_real *y, int n)
{
  FBI_UNROLL
  for (int j = 0; j < n; j += 4) {
    const fb_real a = x[j] * y[j], b = x[j + 1] * y[j + 1], c = x[j + 2] * y[j + 2], d = x[j + 3] * y[j + 3];
    t[j] = a;
    t[j + 1] = b;
    t[j + 2] = c;
    t[j + 3] = d;
  }
}

/* [E8.29] A += tangent stiffness d2U/dq2 of the strain energy, without K. Its geometric part takes tensile strain e
   alone, so that it is never indefinite:
   K + int EA (psi_x (u_y' psi_y + u_z' psi_z) + .. + (u_y' psi_y + u_z' psi_z)^2 + max(e, 0) (psi_y psi_y + psi_z
   psi_z)) dx.
   Source: second derivative of [DB] (27).  Shapes: n x n.  Cost: n^2 stations.  Fails: never.
   Test: the_tangent_is_the_derivative_of_the_forces. */
static void fbi_strain_tangent_add(fb_real *A, const fb_body *body, fb_real slope[3][FBI_MAX_STRAINS])
{
  const int n = body->n;
  fb_real w[3][3][FBI_MAX_STRAINS], t[3][FBI_MAX_STRAINS];

  /* weights of the products of slopes, by axes */
  for (int g = 0; g < body->n_strain; g++) {
    const fb_real EA = body->strain_weight[g], y = slope[1][g], z = slope[2][g];
    const fb_real e = slope[0][g] + FB_R(0.5) * (y * y + z * z), tension = EA * fbi_larger(e, FB_R(0.0));
    w[0][0][g] = FB_R(0.0); /* is in K */
    w[0][1][g] = w[1][0][g] = EA * y;
    w[0][2][g] = w[2][0][g] = EA * z;
    w[1][1][g] = EA * y * y + tension;
    w[1][2][g] = w[2][1][g] = EA * y * z;
    w[2][2][g] = EA * z * z + tension;
  }

  /* A_ab += sum of slope_a w slope_b */
  for (int i = 0; i < body->n_strain_row; i++) {
    const fb_strain_row *a = &body->strain_row[i];
    for (int axis = 0; axis < 3; axis++) {
      fbi_products(t[axis], a->slope, w[a->axis][axis], body->n_strain);
    }
    for (int j = 0; j <= i; j++) {
      const fb_strain_row *b = &body->strain_row[j];
      const fb_real sum = fbi_dot(t[b->axis], b->slope, body->n_strain);
      A[a->a * n + b->a] += sum;
      if (i != j) {
        A[b->a * n + a->a] += sum;
      }
    }
  }
}
#endif

#if FB_WITH_SYSTEM
#if FB_WITH_NONLINEAR_STRAIN
/* y -= s A x, A of E8.29, without forming it. */
static void fbi_strain_tangent_sub(fb_real *y, fb_real s, const fb_body *body, fb_real slope[3][FBI_MAX_STRAINS],
                                   const fb_real *x)
{
  fb_real f[3][FBI_MAX_STRAINS];
  fbi_slopes_eval(f, body, x);
  for (int g = 0; g < body->n_strain; g++) {
    const fb_real EA = s * body->strain_weight[g], u_y = slope[1][g], u_z = slope[2][g];
    const fb_real tension = EA * fbi_larger(slope[0][g] + FB_R(0.5) * (u_y * u_y + u_z * u_z), FB_R(0.0));
    const fb_real bent = u_y * f[1][g] + u_z * f[2][g], strain = f[0][g] + bent;
    f[0][g] = EA * bent;
    f[1][g] = EA * u_y * strain + tension * f[1][g];
    f[2][g] = EA * u_z * strain + tension * f[2][g];
  }
  fbi_slopes_sub(y, body, f);
}
#endif
#endif

#if FB_WITH_NONLINEAR_STRAIN
/* Strain energy without 1/2 q^T K q: 1/2 int EA (u_x' r + r^2/4), r = u_y'^2 + u_z'^2. */
static fb_real fbi_strain_energy(const fb_body *body, const fb_real *q)
{
  fb_real slope[3][FBI_MAX_STRAINS], energy = FB_R(0.0);
  fbi_slopes_eval(slope, body, q);
  for (int g = 0; g < body->n_strain; g++) {
    const fb_real half = FB_R(0.5) * (slope[1][g] * slope[1][g] + slope[2][g] * slope[2][g]);
    energy += body->strain_weight[g] * half * (slope[0][g] + FB_R(0.5) * body->quartic * half);
  }
  return energy;
}
#endif

/* V of a prescribed base: v relative to the frame of state.pi, which moves at state.u (momentum form), or to O and zero
   (the other forms). */
static void fbi_given_velocity(fbi_kinetics *k, const fb_body *body, const fb_state *state, const fb_input *input)
{
  fbi_vec6_zero(k->V);
  if (fbi_form(body) == 0) {
    fb_mat33_mulT_vec3(k->V, k->R, state->u);
    for (int i = 0; i < 3; i++) {
      k->V[i] = (input ? input->v[i] : FB_R(0.0)) - k->V[i];
    }
  }
  if (input) {
    fbi_vec3_copy(k->V + 3, input->w);
  }
}

/* [E8.13] Velocities from momenta, S(q) V = (0, h) - Lambda(q) pb, relative to the mass center; the prescribed ones of
   a prescribed base. On entry k.R is that of state.quat where fbi_is_oriented.
   Source: THEORY.md 8.4, where p = 0.  Fails: S(q) not positive definite (deflection beyond the model's range).
   Test: momenta_agree_with_a_particle_model. */
static fb_status fbi_velocity(fbi_kinetics *k, const fb_body *body, const fb_state *state, const fb_input *input)
{
  fb_real y[6];
  const int n = body->n;

  /* (1, q), M^-1 pi */
  k->qx[0] = FB_R(1.0);
  k->x[0] = FB_R(0.0);
  for (int a = 0; a < n; a++) {
    k->qx[a + 1] = state->q[a];
    k->x[a + 1] = FB_R(0.0);
  }
  k->pb = state->pi;
  if (!body->unit_mass && fbi_form(body) == 0) {
    fbi_mass_solve(k->Minv_pi, body, state->pi);
    k->pb = k->Minv_pi;
  }

  /* velocities that need no solution */
  if (body->base == FB_BASE_PRESCRIBED) {
    fbi_given_velocity(k, body, state, input);
    return FB_OK;
  }
  fbi_vec3_zero(k->V);
  if (fbi_form(body) != 0) { /* v relative to O, which moves at u; L holds w */
    fbi_vec3_copy(k->V + 3, state->L);
    return FB_OK;
  }

  /* y = (0, h) - Lambda(q) pb */
  fbi_vec3_zero(k->ph);
  fbi_vec3_copy(k->ph + 3, state->h);
  fbi_vec6_copy(y, k->ph);
  fbi_lambda_sub(y, body, k->qx, k->pb);

  /* V = S(q)^-1 y */
#if FBI_WITH_SHAPE_INERTIA
  if (!body->constant_S) {
    fbi_S_eval(k->S, body, k->qx, body->n_run);
    if (fbi_base_solve(k->V, body->base, k->S, y) != FB_OK) {
      return fbi_is_finite(k->S, 21) ? FB_ERR_RANGE : FB_ERR_NOT_FINITE;
    }
    return FB_OK;
  }
#endif
  k->V[0] = fbi_vec6_dot(body->S0_inverse, y);
  k->V[1] = fbi_vec6_dot(body->S0_inverse + 6, y);
  k->V[2] = fbi_vec6_dot(body->S0_inverse + 12, y);
  k->V[3] = fbi_vec6_dot(body->S0_inverse + 18, y);
  k->V[4] = fbi_vec6_dot(body->S0_inverse + 24, y);
  k->V[5] = fbi_vec6_dot(body->S0_inverse + 30, y);
  return FB_OK;
}

#if FBI_WITH_QUADRATIC
/* ---- nodes and loads */

/* Index of the 3-vector of modes a, b in a node's table of the second-order displacement field. */
static int fbi_pair(int a, int b)
{
  return 3 * (a > b ? a * (a + 1) / 2 + b : b * (b + 1) / 2 + a);
}
#endif

/* [E8.14] Displacement and rotation of a node, u = psi q + 1/2 chi q q, phi = theta q + 1/2 chi_theta q q (chi:
   second-order displacement field), and their variations J_u,a = psi_a + chi_ab q_b,
   J_phi,a = (t_a + 1/2 phi x t_a) / (1 + phi.phi/4),  t_a = d phi/dq_a = theta_a + chi_theta_ab q_b. phi are the
   parameters 2 tan(angle/2) axis of the rotation (1, phi/2)/|(1, phi/2)|: to second degree they are the rotation
   vector, and J_phi is the exact rate of that rotation, without sine and cosine.
   Source: THEORY.md 8.3; Rodrigues parameters.  Cost: 12 n (n+1) flops.  Fails: never.
   Test: node_kinematics_match_finite_differences. */
static FBI_NOINLINE void fbi_node_eval(fbi_node_field *f, const fb_body *body, const fb_node *node, const fb_real *q)
{
  const int n = body->n;
  fb_real scale;

  /* J_u,a and t_a */
  fbi_zero(f->u, 3);
  fbi_zero(f->phi, 3);
  for (int i = 0; i < 3 * n; i++) {
    f->Ju[i] = node->psi[i];
    f->turn[i] = node->theta[i];
  }
#if FBI_WITH_QUADRATIC
  if (fbi_has(body->effects, FBI_QUADRATIC_EFFECTS)) {
    for (int a = 0; a < n; a++) {
      for (int b = 0; b < n; b++) {
        const int pair = fbi_pair(a, b);
        fbi_vec3_add(f->Ju + 3 * a, q[b], node->chi + pair);
        fbi_vec3_add(f->turn + 3 * a, q[b], node->chi_theta + pair);
      }
    }
  }
#endif

  /* u = 1/2 (psi + J_u) q, phi = 1/2 (theta + t) q */
  for (int a = 0; a < n; a++) {
    for (int i = 0; i < 3; i++) {
      f->u[i] += FB_R(0.5) * q[a] * (node->psi[3 * a + i] + f->Ju[3 * a + i]);
      f->phi[i] += FB_R(0.5) * q[a] * (node->theta[3 * a + i] + f->turn[3 * a + i]);
    }
  }

  /* J_phi,a */
  scale = FB_R(1.0) / (FB_R(1.0) + FB_R(0.25) * fb_vec3_dot(f->phi, f->phi));
  for (int a = 0; a < n; a++) {
    const fb_real *t = f->turn + 3 * a;
    fb_vec3_cross(f->Jphi + 3 * a, f->phi, t);
    for (int i = 0; i < 3; i++) {
      f->Jphi[3 * a + i] = scale * (t[i] + FB_R(0.5) * f->Jphi[3 * a + i]);
    }
  }
}

/* Quaternion of a node's rotation in its body. */
static void fbi_node_quat(fb_real quat[4], const fbi_node_field *f)
{
  quat[0] = FB_R(1.0);
  for (int i = 0; i < 3; i++) {
    quat[1 + i] = FB_R(0.5) * f->phi[i];
  }
  (void)fb_quat_normalize(quat); /* never fails: the norm is at least 1 */
}

/* Rates of J_u,a and t_a along q_dot: sum_b chi_ab q_dot_b. */
static void fbi_node_rates(fb_real *Ju_dot, fb_real *turn_dot, const fb_body *body, const fb_node *node,
                           const fb_real *q_dot)
{
  const int n = body->n;
  fbi_zero(Ju_dot, 3 * n);
  fbi_zero(turn_dot, 3 * n);
#if FBI_WITH_QUADRATIC
  if (fbi_has(body->effects, FBI_QUADRATIC_EFFECTS)) {
    for (int a = 0; a < n; a++) {
      for (int b = 0; b < n; b++) {
        const int pair = fbi_pair(a, b);
        fbi_vec3_add(Ju_dot + 3 * a, q_dot[b], node->chi + pair);
        fbi_vec3_add(turn_dot + 3 * a, q_dot[b], node->chi_theta + pair);
      }
    }
  }
#endif
  (void)node, (void)q_dot;
}

/* y = sum_a q_dot_a x_a over n vectors */
static void fbi_vec3_sum(fb_real y[3], const fb_real *x, const fb_real *q_dot, int n)
{
  fbi_zero(y, 3);
  for (int a = 0; a < n; a++) {
    fbi_vec3_add(y, q_dot[a], x + 3 * a);
  }
}

/* [E8.30] Velocity-dependent acceleration of a node in its body, beside J q_ddot: Ju_dot q_dot and Jphi_dot q_dot =
   (phi_dd + 1/2 phi x phi_dd - 1/2 (phi.phi_dot) J_phi q_dot) / (1 + phi.phi/4),  phi_dd = turn_dot q_dot.
   Source: derivative of E8.14.  Shapes: u_dd, turn_dd 3.  Fails: never.
   Test: node_kinematics_match_finite_differences. */
static void fbi_node_convection(fb_real u_dd[3], fb_real turn_dd[3], const fbi_node_field *f, const fb_body *body,
                                const fb_node *node, const fb_real *q_dot)
{
  const int n = body->n;
  fb_real Ju_dot[3 * FB_MAX_MODES], turn_dot[3 * FB_MAX_MODES], phi_dot[3], phi_dd[3], rate[3];
  const fb_real scale = FB_R(1.0) / (FB_R(1.0) + FB_R(0.25) * fb_vec3_dot(f->phi, f->phi));
  fbi_node_rates(Ju_dot, turn_dot, body, node, q_dot);
  fbi_vec3_sum(u_dd, Ju_dot, q_dot, n);
  fbi_vec3_sum(phi_dd, turn_dot, q_dot, n);
  fbi_vec3_sum(phi_dot, f->turn, q_dot, n);
  fbi_vec3_sum(rate, f->Jphi, q_dot, n);
  fb_vec3_cross(turn_dd, f->phi, phi_dd);
  for (int i = 0; i < 3; i++) {
    turn_dd[i] = scale * (phi_dd[i] + FB_R(0.5) * turn_dd[i] - FB_R(0.5) * fb_vec3_dot(f->phi, phi_dot) * rate[i]);
  }
}

/* [E8.15] A load at a node: f += F, g += T + (r + u) x F, f_e,a += J_u,a.F + J_phi,a.T, on the deformed body.
   Source: virtual work; THEORY.md 8.2 (f, g about O of the deformed body).  Fails: never.
   Test: power_of_loads_is_the_rate_of_energy. */
static FBI_NOINLINE void fbi_load_add(fbi_kinetics *k, const fb_body *body, const fb_load *load, const fb_real *q)
{
  const fb_node *node = &body->node[load->node];
  fbi_node_field f;
  fb_real F[3], T[3], arm[3];

  /* F, T in body axes */
  fbi_copy(F, load->force, 3);
  fbi_copy(T, load->torque, 3);
  if (load->axes == FB_AXES_INERTIAL) {
    fb_mat33_mulT_vec3(F, k->R, load->force);
    fb_mat33_mulT_vec3(T, k->R, load->torque);
  }

  /* node 0: force and torque alone */
  if (load->node == 0) { /* O neither moves nor rotates in the frame */
    for (int i = 0; i < 3; i++) {
      k->fg[i] += F[i];
      k->fg[3 + i] += T[i];
    }
    return;
  }

  /* rotate from the axes of the section */
  fbi_node_eval(&f, body, node, q);
  if (load->axes == FB_AXES_NODE) {
    fb_real turn[4], section[9];
    fbi_node_quat(turn, &f);
    fb_quat_to_mat33(section, turn);
    fb_mat33_mul_vec3(F, section, load->force);
    fb_mat33_mul_vec3(T, section, load->torque);
  }

  /* force and torque about O; generalized forces */
  for (int i = 0; i < 3; i++) {
    arm[i] = node->r[i] + f.u[i];
    k->fg[i] += F[i];
    k->fg[3 + i] += T[i];
  }
  fbi_vec3_add_cross(k->fg + 3, arm, F);
  for (int a = 0; a < body->n; a++) {
    k->x[a + 1] += fb_vec3_dot(f.Ju + 3 * a, F) + fb_vec3_dot(f.Jphi + 3 * a, T);
  }
}

/* [E8.16] Forces of a uniform acceleration field g, of potential -m g.rho - g.R c(q), c(q) = c + P q + 1/2 p^chi q q
   the first moment of mass: force m g, torque c(q) x g, modal forces x += (dc/dq)^T g, x indexed as (1, q). c and its
   gradient come from the terms of the linear momentum in Lambda. g in body axes; yields c and x.
   Source: potential energy.  Cost: 8 flops a term.  Fails: never.
   Test: a_falling_body_does_not_deform, power_of_loads_is_the_rate_of_energy. */
static void fbi_pull_eval(fb_real c[3], fb_real *x, const fb_body *body, const fb_real *qx, const fb_real g[3])
{
  const fb_lambda_term *t = body->lambda;
  fbi_copy(c, body->c, 3);
  for (const fb_lambda_term *end = t + body->n_linear_constant; t < end; t++) {
    c[t->i] -= t->c * qx[t->b + 1];
    x[t->b + 1] -= t->c * g[t->i];
  }
  t = body->lambda + body->n_lambda_constant;
  for (const fb_lambda_term *end = t + body->n_linear; t < end; t++) {
    const fb_real s = t->c * qx[t->a];
    c[t->i] -= FB_R(0.5) * s * qx[t->b + 1];
    x[t->b + 1] -= s * g[t->i];
  }
}

#if FB_WITH_GRAVITY
static void fbi_gravity_add(fbi_kinetics *k, const fb_body *body)
{
  fb_real g[3], c[3];
  fb_mat33_mulT_vec3(g, k->R, body->gravity);
  fbi_pull_eval(c, k->x, body, k->qx, g);
  fbi_vec3_add(k->fg, body->mass, g);
  fbi_vec3_add_cross(k->fg + 3, c, g);
}
#endif

static fb_status fbi_input_check(const fb_body *body, const fb_input *input)
{
  if (!input) {
    return FB_OK;
  }
  FBI_REQUIRE(input->n_load >= 0 && input->n_load <= FB_MAX_LOADS, FB_ERR_CAPACITY);
  for (int i = 0; i < input->n_load; i++) {
    FBI_REQUIRE(input->load[i].node >= 0 && input->load[i].node < body->n_node, FB_ERR_CAPACITY);
    FBI_REQUIRE(fbi_is_choice((int)input->load[i].axes, (int)FB_AXES_COUNT - 1), FB_ERR_VALUE);
    if (!fbi_vec3_is_finite(input->load[i].force) || !fbi_vec3_is_finite(input->load[i].torque)) {
      /* no other check sees loads on a prescribed base */
      return FBI_REFUSE(FB_ERR_NOT_FINITE, "load: force [N] or torque [N m], finite", i, FB_R(0.0), FB_R(0.0));
    }
  }
  return FB_OK;
}

/* 1 if the frame of the momenta moves with the mass center: free bodies in momentum form. */
static int fbi_is_flying(const fb_body *body)
{
  return body->base == FB_BASE_FREE && fbi_form(body) == 0;
}

/* 1 if the rates depend on the attitude: in momentum form not without loads, if the body is free, or pinned or hinged
   without gravity. */
static int fbi_is_oriented(const fb_body *body, const fb_input *input)
{
  return fbi_form(body) != 0 || body->base == FB_BASE_PRESCRIBED || (input && input->n_load > 0) ||
         (body->base != FB_BASE_FREE && fbi_has(body->effects, FB_EFFECT_GRAVITY));
}

/* [E8.33] Loads in the frame of the mass center, which they accelerate by a = f/m: there every mass element feels the
   uniform field -a, so that the force vanishes, the torque is that about the mass center, g - c(q) x f/m, and modes
   get -(dc/dq)^T a. Gravity accelerates all mass elements alike and drops out.
   Source: Newton-Euler in the frame of the mass center (Koenig).  Cost: 8 flops a term.  Fails: never.
   Test: flight_speed_does_not_matter, power_of_loads_is_the_rate_of_energy. */
static void fbi_fall(fbi_kinetics *k, const fb_body *body)
{
  fb_real field[3], c[3];
  for (int i = 0; i < 3; i++) {
    k->a[i] = k->fg[i] / body->mass;
    field[i] = -k->a[i];
    k->fg[i] = FB_R(0.0);
  }
  fbi_pull_eval(c, k->x, body, k->qx, field);
  fbi_vec3_add_cross(k->fg + 3, c, field);
}

/* k.fg, k.x, k.a of gravity and loads; relative to the mass center (E8.33) for a free body in momentum form. */
static void fbi_forces(fbi_kinetics *k, const fb_body *body, const fb_state *state, const fb_input *input)
{
  const int n_load = input ? input->n_load : 0, flying = fbi_is_flying(body);
  fbi_vec6_zero(k->fg);
  k->loaded = n_load > 0 || (fbi_has(body->effects, FB_EFFECT_GRAVITY) && !flying);
#if FB_WITH_GRAVITY
  if (fbi_has(body->effects, FB_EFFECT_GRAVITY) && !flying) {
    fbi_gravity_add(k, body);
  }
#endif
  for (int i = 0; i < n_load; i++) {
    fbi_load_add(k, body, &input->load[i], state->q);
  }
  fbi_vec3_zero(k->a);
  if (flying && n_load > 0) {
    fbi_fall(k, body);
  }
}

/* y += s (C x) where damping is on */
static void fbi_damping_add(fb_real *y, fb_real s, const fb_body *body, const fb_real *x)
{
#if FB_WITH_DAMPING
  if (fbi_has(body->effects, FB_EFFECT_DAMPING)) {
    fbi_sparse_eval(y, y, s, &body->C, x, body->n);
  }
#endif
  (void)y, (void)s, (void)body, (void)x;
}

/* f = x - dU/dq - C q_dot; U = 1/2 q^T K q and the strain energy of E8.23. */
static void fbi_elastic_forces(fb_real *f, fbi_kinetics *k, const fb_body *body, const fb_real *q, const fb_real *q_dot)
{
#if FB_WITH_NONLINEAR_STRAIN
  if (fbi_has(body->effects, FB_EFFECT_NONLINEAR_STRAIN)) {
    fbi_strain_sub(k->x + 1, k->slope, body, q, body->quartic);
  }
#endif
  fbi_sparse_eval(f, k->x + 1, FB_R(-1.0), &body->K, q, body->n);
  fbi_damping_add(f, -FB_R(1.0), body, q_dot);
}

/* turn = (w x p, w x h + v x p), the transport term of momenta in rotating axes */
static void fbi_turning(fb_real turn[6], const fb_real V[6], const fb_real ph[6])
{
  fb_vec3_cross(turn, V + 3, ph);
  fb_vec3_cross(turn + 3, V + 3, ph + 3);
  fbi_vec3_add_cross(turn + 3, V, ph);
}

/* [E8.17] Elastic equations.
   q_dot = M^-1 (pi - Lambda(q)^T V),  pi_dot = f_e - K q - C q_dot + d/dq (V^T Lambda(q) pb + 1/2 V^T S(q) V).
   These are Hamilton's equations of 1/2 y^T S^-1 y + 1/2 pi^T M^-1 pi + U, so every choice of terms conserves energy.
   Source: THEORY.md 8.2; [DB] (23), (25).  Fails: never.  Test: accelerations_agree_with_a_particle_model. */
static void fbi_elastic_rates(fb_state *rate, fbi_kinetics *k, const fb_body *body, const fb_state *state)
{
  fb_real *e = body->unit_mass ? rate->q : k->e; /* pi - Lambda^T V */
  fbi_copy(e, state->pi, body->n);
  fbi_lambda_gradients(e, k->x, body, k->V, k->qx, k->pb);
#if FBI_WITH_SHAPE_INERTIA
  if (!body->constant_S) {
    fbi_S_gradient(k->x, body, k->V, k->qx);
  }
#endif
  if (!body->unit_mass) {
    fbi_mass_solve(rate->q, body, k->e);
  }
  fbi_elastic_forces(rate->pi, k, body, state->q, rate->q);
}

/* [E8.18] Rigid-body equations: quat_dot = 1/2 quat o (0, w), u_dot = R a + gravity, L_dot = R g in inertial axes, and
   redundantly h_dot = g - w x h in body axes. Velocities follow from h: with h = R^T L, w = S^-1 h would amplify an
   error of the attitude by the ratio of inertias of a slender body, without bound. E11.29 reconciles h and L.
   Without loads u and L are constant up to round-off for ANY Runge-Kutta step. rho of a free body moves with the mass
   center; E11.30 then recovers that of O.
   Source: Newton-Euler about the mass center; THEORY.md 8.4.  Cost: 60 flops.  Fails: never.
   Test: tumbling_conserves_momentum_and_energy, slender_bodies_keep_their_energy. */
static void fbi_rigid_rates(fb_state *rate, const fbi_kinetics *k, const fb_body *body, const fb_state *state)
{

  /* pose */
  fbi_vec3_copy(rate->rho, state->u);
  fbi_quat_rate(rate->quat, state->quat, k->V + 3);

  /* a prescribed base has no momentum equations */
  fbi_vec3_zero(rate->u);
  fbi_vec3_zero(rate->L);
  fbi_vec3_zero(rate->h);
  if (body->base == FB_BASE_PRESCRIBED) {
    fb_real v[3];
    fb_mat33_mul_vec3(v, k->R, k->V);
    fbi_vec3_add(rate->rho, FB_R(1.0), v);
    return;
  }

  /* momenta */
  if (k->loaded) {
    fbi_copy(rate->h, k->fg + 3, 3);
    fbi_turning_part(rate->h, body->base);
    fb_mat33_mul_vec3(rate->L, k->R, rate->h);
    fb_mat33_mul_vec3(rate->u, k->R, k->a);
  }
  fbi_vec3_add_cross(rate->h, k->ph + 3, k->V + 3);
#if FB_WITH_GRAVITY
  if (body->base == FB_BASE_FREE && fbi_has(body->effects, FB_EFFECT_GRAVITY)) {
    fbi_vec3_add(rate->u, FB_R(1.0), body->gravity);
  }
#endif
}

static fb_status fbi_momentum_rates(fb_state *rate, fbi_kinetics *k, const fb_body *body, const fb_state *state)
{
  fbi_elastic_rates(rate, k, body, state);
  fbi_rigid_rates(rate, k, body, state);
  return FB_OK;
}

/* ---- second-order and first-order forms */

static const fb_real fbi_origin[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)};

/* Acceleration of O of a prescribed base, body axes: v_dot + w x v. */
static void fbi_given_acceleration(fb_real a[3], const fb_input *input)
{
  fb_vec3_cross(a, input->w, input->v);
  fbi_vec3_add(a, FB_R(1.0), input->v_dot);
}

#if FB_WITH_FORMS
/* (p, h) = M_rr V + Lambda pb by the mass matrix of the form, of q (second order) or constant (first); k.S = M_rr. */
static void fbi_form_momenta(fbi_kinetics *k, const fb_body *body)
{
  if (body->form == FB_FORM_SECOND) {
    fbi_S_eval(k->S, body, k->qx, body->n_run_value);
  } else {
    fbi_copy(k->S, body->M_rr, 21);
  }
  fb_sym6_mul_vec6(k->ph, k->S, k->V);
  for (int t = 0; t < body->n_lambda_value; t++) {
    const fb_lambda_term *term = &body->lambda[t];
    k->ph[term->i] -= term->c * k->qx[term->a] * k->pb[term->b];
  }
}

/* e -= Lambda^T V, Lambda of the mass matrix of the form */
static void fbi_form_lambda_sub(fb_real *e, const fb_body *body, const fb_real V[6], const fb_real *qx)
{
  for (int t = 0; t < body->n_lambda_value; t++) {
    const fb_lambda_term *term = &body->lambda[t];
    e[term->b] += term->c * qx[term->a] * V[term->i];
  }
}

/* Rates of the pose; V_dot of a prescribed base, else zero. */
static void fbi_form_pose(fb_state *rate, fbi_kinetics *k, const fb_body *body, const fb_state *state,
                          const fb_input *input)
{
  const int given = body->base == FB_BASE_PRESCRIBED && input;
  fbi_copy(rate->rho, state->u, 3);
  fbi_quat_rate(rate->quat, state->quat, k->V + 3);
  fbi_zero(k->V_dot, 6);
  if (given) {
    fbi_given_acceleration(k->V_dot, input);
    fbi_copy(k->V_dot + 3, input->w_dot, 3);
    fb_mat33_mul_vec3(rate->rho, k->R, input->v);
  }
}

/* Rates of the velocities in the state, u of O in inertial axes and L = w in body axes; zero for a prescribed base. */
static void fbi_form_velocity_rates(fb_state *rate, const fbi_kinetics *k, const fb_body *body)
{
  fbi_zero(rate->u, 3);
  fbi_zero(rate->L, 3);
  fbi_zero(rate->h, 3);
  if (body->base != FB_BASE_PRESCRIBED) {
    fb_mat33_mul_vec3(rate->u, k->R, k->V_dot);
    fbi_copy(rate->L, k->V_dot + 3, 3);
  }
}

/* A = mass matrix of the second-order form, size x size: the rigid-body rows from first on, then the elastic ones. */
static void fbi_second_matrix(fb_real *A, const fbi_kinetics *k, const fb_body *body, int first, int size)
{
  const int rigid = 6 - first;
  fbi_zero(A, size * size);

  /* M_rr(q) */
  for (int i = first; i < 6; i++) {
    for (int j = first; j < 6; j++) {
      A[(i - first) * size + j - first] = k->S[fb_sym6_index(i, j)];
    }
  }

  /* Lambda(q) and its transpose */
  for (int t = 0; t < body->n_lambda_value; t++) {
    const fb_lambda_term *term = &body->lambda[t];
    const int row = term->i - first, column = rigid + term->b;
    if (row >= 0) {
      A[row * size + column] -= term->c * k->qx[term->a];
      A[column * size + row] -= term->c * k->qx[term->a];
    }
  }

  /* M */
  for (int a = 0; a < body->n; a++) {
    A[(rigid + a) * (size + 1)] = body->M.diagonal[a];
  }
  for (int t = 0; t < body->M.n_term; t++) {
    const int a = rigid + body->M.term[t].a, b = rigid + body->M.term[t].b;
    A[a * size + b] = A[b * size + a] = body->M.term[t].c;
  }
}

/* [E8.25] Second-order form. With y = (f, g) - transport term of (p, h) - M_rr_dot V - Lambda_dot q_dot
   [M_rr(q) Lambda(q); Lambda(q)^T M] (V_dot; q_ddot) =
     (y; f_e - dU/dq - C q_dot - Lambda_dot^T V + d/dq (V^T Lambda q_dot + 1/2 V^T M_rr V)),
   solved by dense LU at every evaluation. Written out for a linear displacement field these are the printed equations:
   Lambda = M_re(q) = [P; h(q)], M_rr(q) = [m 1, -c(q)^; c(q)^, J(q)].
   Source: [DB] (7)-(8) with ERRATA.md DB1 and DB2.  Cost: 2/3 (n+6)^3 flops.  Fails: mass matrix singular.
   Test: second_order_form_is_the_printed_one, forms_agree_on_a_closed_basis. */
static fb_status fbi_second_rates(fb_state *rate, fbi_kinetics *k, const fb_body *body, const fb_state *state)
{
  const int n = body->n, first = fbi_first_free(body->base), size = 6 - first + n;
  fb_real A[(FB_MAX_MODES + 6) * (FB_MAX_MODES + 6)], b[FB_MAX_MODES + 6], x[FB_MAX_MODES + 6], scale[FB_MAX_MODES + 6];
  fb_real xd[FB_MAX_MODES + 1], turn[6], SV[6], *f = b + 6 - first;
  int perm[FB_MAX_MODES + 6];
  fb_status status;

  /* y: right-hand side of the rigid-body rows */
  xd[0] = FB_R(0.0);
  fbi_copy(xd + 1, k->pb, n);
  fbi_form_momenta(k, body);
  fbi_turning(turn, k->V, k->ph);
  fbi_S_rate(k->dS, body, k->qx, xd);
  fb_sym6_mul_vec6(SV, k->dS, k->V);
  for (int i = 0; i < 6; i++) {
    k->y[i] = k->fg[i] - turn[i] - SV[i];
  }
  fbi_lambda_linear_sub(k->y, body, xd, k->pb);
  fbi_copy(b, k->y + first, 6 - first);

  /* f: right-hand side of the elastic rows; k.e = -Lambda_dot^T V */
  fbi_zero(k->e, n);
  fbi_lambda_linear_gradients(k->e, k->x, body, k->V, xd, k->pb);
  fbi_S_gradient(k->x, body, k->V, k->qx);
  if (first == 6) {
    fbi_form_lambda_sub(k->e, body, k->V_dot, k->qx);
  }
  fbi_elastic_forces(f, k, body, state->q, k->pb);
  for (int a = 0; a < n; a++) {
    f[a] += k->e[a];
  }

  /* accelerations */
  fbi_second_matrix(A, k, body, first, size);
  status = fb_lu_factor(A, perm, scale, size);
  if (status != FB_OK) {
    return status == FB_ERR_SINGULAR ? FB_ERR_RANGE : status;
  }
  fb_lu_solve(x, A, perm, b, size);
  fbi_copy(k->V_dot + first, x, 6 - first);
  fbi_copy(rate->q, k->pb, n);
  fbi_copy(rate->pi, x + 6 - first, n);
  return FB_OK;
}

#if FB_WITH_NONLINEAR_STRAIN
/* [E8.26] Stiffness torque as printed, degrees 2 and 3 by quadrature of the slopes at the strain stations, degree 1
   from the table of E8.24: g_s,3 = .. + int EA (-u_x'^2 + 1/2 r - 1/2 u_x' r) u_y' dx, g_s,2 the same with -u_z',
   r = u_y'^2 + u_z'^2.
   g -= g_s.
   Source: [DB] (34)-(36) with ERRATA.md DB10 and DB11.  Cost: 10 flops a station.  Fails: never.
   Test: stiffness_torques_agree_on_a_closed_basis, spin_up_follows_the_references_of_each_form. */
static void fbi_printed_torque_sub(fb_real g[3], const fbi_kinetics *k, const fb_body *body)
{
  const fb_real second = body->torque_degree >= 2 ? FB_R(1.0) : FB_R(0.0);
  const fb_real third = body->torque_degree >= 3 ? FB_R(1.0) : FB_R(0.0);
  for (int t = 0; t < body->n_torque; t++) {
    const fb_lambda_term *term = &body->torque[t];
    g[term->i] -= term->c * k->qx[term->a] * k->qx[term->b + 1];
  }
  for (int s = 0; s < body->n_strain; s++) {
    const fb_real x = k->slope[0][s], y = k->slope[1][s], z = k->slope[2][s], half = FB_R(0.5) * (y * y + z * z);
    const fb_real c = body->strain_weight[s] * (second * (half - x * x) - third * x * half);
    g[1] += c * z;
    g[2] -= c * y;
  }
}
#endif

/* [E8.27] Stiffness and load torque by the identities q_b Upsilon_b M^-1 dU/dq = K_re q, q_b Upsilon_b M^-1 f_e =
   F_re q: forces on the modes act on the frame through the v_e that rotate with it. y += F_re q - K_re q; loads: f_e,
   elastic: -dU/dq and damping. With a printed K_re dU/dq is left out; otherwise its terms up to torque_degree are in.
   Source: [DB] (49), (50).  Cost: 3 n_lambda flops.  Fails: never.
   Test: stiffness_torques_agree_on_a_closed_basis, spin_up_follows_the_references_of_each_form. */
static void fbi_identity_torque_add(fb_real y[6], const fbi_kinetics *k, const fb_body *body, const fb_real *q,
                                    const fb_real *q_dot, const fb_real *loads, const fb_real *elastic)
{
  fb_real f[FB_MAX_MODES] = {FB_R(0.0)}, acceleration[FB_MAX_MODES];
  fbi_copy(f, loads, body->n);
  if (body->stiffness_torque == FB_TORQUE_IDENTITY && body->torque_degree == 3) {
    for (int a = 0; a < body->n; a++) {
      f[a] += elastic[a];
    }
  } else {
    fbi_damping_add(f, -FB_R(1.0), body, q_dot);
  }
  if (body->stiffness_torque == FB_TORQUE_IDENTITY && body->torque_degree > 0 && body->torque_degree < 3) {
    fbi_sparse_eval(f, f, FB_R(-1.0), &body->K, q, body->n);
#if FB_WITH_NONLINEAR_STRAIN
    if (body->torque_degree == 2 && fbi_has(body->effects, FB_EFFECT_NONLINEAR_STRAIN)) {
      fb_real slope[3][FBI_MAX_STRAINS];
      fbi_strain_sub(f, slope, body, q, FB_R(0.0));
    }
#endif
  }
  fbi_mass_solve(acceleration, body, f);
  fbi_lambda_linear_sub(y, body, k->qx, acceleration);
}

/* Velocity-dependent inertia forces of the first-order form, [DB] (23): y = (f, g) less those of the rigid-body rows; f
   and k.x take those of the elastic rows. */
static void fbi_first_inertia(fb_real *f, fbi_kinetics *k, const fb_body *body)
{
  const fb_real *w = k->V + 3;
  fb_real wv[6] = {0}, wp[3], cwv[3], Jw[3], wJw[3], G[9] = {0}, Gw[3];

  /* w x v, w x p, c x (w x v), w x J w */
  fbi_form_momenta(k, body);
  fb_vec3_cross(wv, w, k->V);
  fb_vec3_cross(wp, w, k->ph);
  fb_vec3_cross(cwv, body->c, wv);
  Jw[0] = k->S[15] * w[0] + k->S[16] * w[1] + k->S[17] * w[2];
  Jw[1] = k->S[16] * w[0] + k->S[18] * w[1] + k->S[19] * w[2];
  Jw[2] = k->S[17] * w[0] + k->S[19] * w[1] + k->S[20] * w[2];
  fb_vec3_cross(wJw, w, Jw);

  /* Gamma: sum_a v_a Gamma_a^T w; k.x += w^T Gamma_a w */
  for (int t = 0; t < body->n_gam; t++) {
    const fb_lambda_term *term = &body->gam[t];
    G[term->i] += term->c * k->pb[term->a - 1];
    k->x[term->a] += term->c * w[term->i / 3] * w[term->i % 3];
  }
  fb_mat33_mulT_vec3(Gw, G, w);

  /* y, f */
  for (int i = 0; i < 3; i++) {
    k->y[i] = k->fg[i] - wp[i];
    k->y[3 + i] = k->fg[3 + i] - cwv[i] - wJw[i] - Gw[i];
  }
  fbi_zero(f, body->n);
  fbi_form_lambda_sub(f, body, wv, k->qx);
}

/* q_dot = v_e + M^-1 q_b Ups_b^T w; adds the gyroscopic (Coriolis) forces -ups_ab.w v_b to k.x. */
static void fbi_elastic_rotation(fb_real *q_dot, fbi_kinetics *k, const fb_body *body)
{
  fbi_zero(k->e, body->n);
  fbi_lambda_linear_gradients(k->e, k->x, body, k->V, k->qx, k->pb);
  fbi_mass_solve(q_dot, body, k->e);
  for (int a = 0; a < body->n; a++) {
    q_dot[a] += k->pb[a];
  }
}

/* [E8.28] First-order form: with the constant mass matrix
   m v_dot - c^ w_dot + P v_e_dot + w x (m v - c^ w + P v_e) = f
   c^ v_dot + J w_dot + H v_e_dot + c^ (w x v) + w x J w + sum_a v_a Gamma_a^T w + g_s(q) = g + F_re q
   P^T v_dot + H^T w_dot + M v_e_dot + P^T (w x v) - w^T Gamma_a w + w^T ups_ab v_b + dU/dq = f_e
   q_dot = v_e + M^-1 q_b Ups_b^T w
   solved by the Schur complement of M, a constant 6x6 whose inverse is part of the model.
   Source: [DB] (23)-(25); F_re q by E8.27.  Cost: 4 n_lambda + 300 flops.
   Fails: never.  Test: forms_agree_on_a_closed_basis, spin_up_follows_the_references_of_each_form. */
static void fbi_first_rates(fb_state *rate, fbi_kinetics *k, const fb_body *body, const fb_state *state)
{
  const int n = body->n;
  fb_real f[FB_MAX_MODES] = {0}, loads[FB_MAX_MODES] = {0}, elastic[FB_MAX_MODES], a[FB_MAX_MODES], y[6];

  /* q_dot; inertia forces and loads */
  fbi_copy(loads, k->x + 1, n);
  fbi_zero(k->x + 1, n);
  fbi_elastic_rotation(rate->q, k, body);
  fbi_first_inertia(f, k, body);
  for (int i = 0; i < n; i++) {
    f[i] += loads[i] + k->x[i + 1];
    k->x[i + 1] = FB_R(0.0);
  }

  /* elastic forces; their torque and that of the loads on the frame */
  fbi_elastic_forces(elastic, k, body, state->q, rate->q);
#if FB_WITH_NONLINEAR_STRAIN
  if (body->stiffness_torque != FB_TORQUE_IDENTITY) {
    fbi_printed_torque_sub(k->y + 3, k, body);
  }
#endif
  fbi_identity_torque_add(k->y, k, body, state->q, rate->q, loads, elastic);
  for (int i = 0; i < n; i++) {
    f[i] += elastic[i];
  }

  /* V_dot = S_0^-1 (y - Lambda M^-1 f) */
  if (body->base != FB_BASE_PRESCRIBED) {
    fbi_copy(y, k->y, 6);
    fbi_mass_solve(a, body, f);
    for (const fb_lambda_term *t = body->lambda; t < body->lambda + body->n_lambda_constant; t++) {
      y[t->i] += t->c * a[t->b];
    }
    for (int i = 0; i < 6; i++) {
      k->V_dot[i] = fbi_vec6_dot(body->S0_inverse + 6 * i, y);
    }
  }

  /* v_e_dot = M^-1 (f - Lambda^T V_dot) */
  fbi_form_lambda_sub(f, body, k->V_dot, k->qx);
  fbi_mass_solve(rate->pi, body, f);
}

static fb_status fbi_form_rates(fb_state *rate, fbi_kinetics *k, const fb_body *body, const fb_state *state,
                                const fb_input *input)
{
  fb_status status = FB_OK;
  if (body->form == FB_FORM_MOMENTUM) {
    return fbi_momentum_rates(rate, k, body, state);
  }
  fbi_form_pose(rate, k, body, state, input);
  if (body->form == FB_FORM_SECOND) {
    status = fbi_second_rates(rate, k, body, state);
  } else {
    fbi_first_rates(rate, k, body, state);
  }
  fbi_form_velocity_rates(rate, k, body);
  return status;
}
#endif

static fb_status fbi_rates(fb_state *rate, fbi_kinetics *k, const fb_body *body, const fb_state *state,
                           const fb_input *input)
{
  const fb_status status = fbi_velocity(k, body, state, input);
  if (status != FB_OK) {
    return status;
  }
  fbi_forces(k, body, state, input);
#if FB_WITH_FORMS
  return fbi_form_rates(rate, k, body, state, input);
#else
  return fbi_momentum_rates(rate, k, body, state);
#endif
}

static int fbi_state_is_finite(const fb_state *state, int n)
{
  return fbi_is_finite(state->rho, 3) && fbi_is_finite(state->quat, 4) && fbi_is_finite(state->u, 3) &&
         fbi_is_finite(state->L, 3) && fbi_is_finite(state->h, 3) && fbi_is_finite(state->q, n) &&
         fbi_is_finite(state->pi, n);
}

/* Copies the pose and the momenta of the frame, which are not stiff. */
static void fbi_frame_copy(fb_state *out, const fb_state *in)
{
  fbi_vec3_copy(out->rho, in->rho);
  fbi_vec3_copy(out->quat, in->quat);
  out->quat[3] = in->quat[3];
  fbi_vec3_copy(out->u, in->u);
  fbi_vec3_copy(out->L, in->L);
  fbi_vec3_copy(out->h, in->h);
}

/* 1 if the attitude follows from the angular momentum about all axes: free and pinned bodies in momentum form. */
static int fbi_is_turned(const fb_body *body)
{
  return fbi_form(body) == 0 && (body->base == FB_BASE_FREE || body->base == FB_BASE_PINNED);
}

#if FB_SINGLE
/* h = R^T L */
static void fbi_turning_back(fb_real h[3], const fb_state *state)
{
  fb_real R[9];
  fb_quat_to_mat33(R, state->quat);
  fb_mat33_mulT_vec3(h, R, state->L);
}

/* Updates lost_h, the part of h across R^T L that the rounding of R^T L has lost: eps of L is much spin about an axis
   of little inertia. more: increment of h since `from`; the differences are small and lose nothing.
   Test: slender_bodies_keep_their_energy. */
static FBI_NOINLINE void fbi_turning_keep(fb_state *next, const fb_state *from, const fb_body *body,
                                          const fb_real more[3])
{
  fb_real before[3], after[3], size;
  fbi_zero(next->lost_h, 3);
  if (!fbi_is_turned(body)) {
    return;
  }
  fbi_turning_back(before, from);
  fbi_turning_back(after, next);
  size = fb_vec3_dot(after, after);
  if (!(size > FB_R(0.0))) {
    return;
  }
  for (int i = 0; i < 3; i++) {
    next->lost_h[i] = from->lost_h[i] + ((before[i] - after[i]) + more[i]);
  }
  fbi_vec3_add(next->lost_h, -fb_vec3_dot(next->lost_h, after) / size, after);
}
#endif

static void fbi_elastic_copy(fb_state *out, const fb_state *in, int n)
{
  for (int a = 0; a < n; a++) {
    out->q[a] = in->q[a];
    out->pi[a] = in->pi[a];
  }
}

/* Copies the part of a state that a body uses; sets R and h = R^T L, plus lost_h in single precision. */
static FBI_NOINLINE void fbi_state_enter(fb_state *out, fb_real R[9], const fb_body *body, const fb_state *state)
{
  fbi_vec3_copy(out->rho, state->rho);
  fbi_vec3_copy(out->quat, state->quat);
  out->quat[3] = state->quat[3];
  fbi_vec3_copy(out->u, state->u);
  fbi_vec3_copy(out->L, state->L);
  fbi_elastic_copy(out, state, body->n);
  fb_quat_to_mat33(R, state->quat);
  fb_mat33_mulT_vec3(out->h, R, state->L);
#if FB_SINGLE
  fbi_row_sub(out->h, -FB_R(1.0), state->lost_h, 3);
#endif
}

/* 1 for a prescribed base in momentum form: its elastic momenta are relative to a frame that follows the base. */
static int fbi_is_following(const fb_body *body)
{
  return body->base == FB_BASE_PRESCRIBED && fbi_form(body) == 0;
}

/* [E8.35] Elastic momenta relative to a frame that is faster by du (inertial axes): pi -= (dc/dq)^T R^T du, the impulse
   of a uniform field.
   Source: E8.16.  Cost: 5 flops a term.  Fails: never.  Test: flight_speed_does_not_matter,
   the_speed_of_a_prescribed_base_does_not_matter. */
static void fbi_frame_shift(fb_real *pi, const fb_body *body, const fb_real *q, const fb_real R[9], const fb_real du[3])
{
  const fb_lambda_term *t = body->lambda;
  fb_real back[3];
  fb_mat33_mulT_vec3(back, R, du);
  for (const fb_lambda_term *end = t + body->n_linear_constant; t < end; t++) {
    pi[t->b] += t->c * back[t->i];
  }
  t = body->lambda + body->n_lambda_constant;
  for (const fb_lambda_term *end = t + body->n_linear; t < end; t++) {
    pi[t->b] += t->c * back[t->i] * q[t->a - 1];
  }
}

/* [E8.34] First moment of mass c(q) = c + P q + 1/2 p^chi q q, body axes [kg m].
   Source: E8.16.  Cost: 4 flops a term.  Fails: never.  Test: the_mass_center_goes_where_momentum_leads_it. */
static void fbi_center_eval(fb_real c[3], const fb_body *body, const fb_real *q)
{
  const fb_lambda_term *t = body->lambda;
  fbi_copy(c, body->c, 3);
  for (const fb_lambda_term *end = t + body->n_linear_constant; t < end; t++) {
    c[t->i] -= t->c * q[t->b];
  }
  t = body->lambda + body->n_lambda_constant;
  for (const fb_lambda_term *end = t + body->n_linear; t < end; t++) {
    c[t->i] -= FB_R(0.5) * t->c * q[t->a - 1] * q[t->b];
  }
}

/* c(q) before and after a step by one pass over the terms; the sums of a row stay in registers. */
static void fbi_center_pair(fb_real before[3], fb_real after[3], const fb_body *body, const fb_real *q,
                            const fb_real *next)
{
  const fb_lambda_term *t = body->lambda;
  fbi_vec3_copy(before, body->c);
  fbi_vec3_copy(after, body->c);
  for (const fb_lambda_term *end = t + body->n_linear_constant; t < end; t++) {
    before[t->i] -= t->c * q[t->b];
    after[t->i] -= t->c * next[t->b];
  }
  t = body->lambda + body->n_lambda_constant;
  for (const fb_lambda_row *r = body->lambda_row; r < body->lambda_row + body->n_row && r->i < 3; r++) {
    fb_real old = FB_R(0.0), sum = FB_R(0.0);
    for (const fb_lambda_term *end = body->lambda + r->end; t < end; t++) {
      old += t->c * q[t->a - 1] * q[t->b];
      sum += t->c * next[t->a - 1] * next[t->b];
    }
    before[r->i] -= FB_R(0.5) * old;
    after[r->i] -= FB_R(0.5) * sum;
  }
}

/* Rate of c(q) in body axes, (dc/dq) q_dot. */
static void fbi_center_rate(fb_real c_dot[3], const fb_body *body, const fb_real *q, const fb_real *q_dot)
{
  const fb_lambda_term *t = body->lambda;
  fbi_zero(c_dot, 3);
  for (const fb_lambda_term *end = t + body->n_linear_constant; t < end; t++) {
    c_dot[t->i] -= t->c * q_dot[t->b];
  }
  t = body->lambda + body->n_lambda_constant;
  for (const fb_lambda_term *end = t + body->n_linear; t < end; t++) {
    c_dot[t->i] -= t->c * q[t->a - 1] * q_dot[t->b];
  }
}

/* Velocity of O, inertial axes: u - R (w x c + c_dot)/m where u is that of the mass center, else u + R v. */
static void fbi_origin_velocity(fb_real v[3], const fbi_kinetics *k, const fb_body *body, const fb_state *state,
                                const fb_real *q_dot)
{
  fb_real own[3], c[3];
  fbi_copy(own, k->V, 3);
  if (fbi_is_flying(body)) {
    fbi_center_eval(c, body, k->qx + 1);
    fbi_center_rate(own, body, k->qx + 1, q_dot);
    fbi_vec3_add_cross(own, k->V + 3, c);
    for (int i = 0; i < 3; i++) {
      own[i] /= -body->mass;
    }
  }
  fb_mat33_mul_vec3(v, k->R, own);
  fbi_vec3_add(v, FB_R(1.0), state->u);
}

FB_DEF fb_status fb_body_rates_eval(const fb_body *body, fb_state *rate, const fb_state *state, const fb_input *input)
{
  fbi_kinetics k;
  fb_state out, at;
  fb_status status;
  FBI_REQUIRE(body && rate && state, FB_ERR_NULL);
  status = fbi_input_check(body, input);
  fbi_state_enter(&at, k.R, body, state);
  memset(&out, 0, sizeof out);
  status = status == FB_OK ? fbi_rates(&out, &k, body, &at, input) : status;
  if (status == FB_OK && fbi_is_flying(body)) {
    fbi_origin_velocity(out.rho, &k, body, &at, out.q);
  }
  status = status == FB_OK && !fbi_state_is_finite(&out, body->n) ? FB_ERR_NOT_FINITE : status;
  if (status == FB_OK) {
    *rate = out;
  }
  return status;
}

/* ---- state, motion, energy, momentum */

FB_DEF fb_status fb_state_init(const fb_body *body, fb_state *state)
{
  FBI_REQUIRE(body && state, FB_ERR_NULL);
  FBI_REQUIRE_EXACT();
  memset(state, 0, sizeof *state);
  state->quat[0] = FB_R(1.0);
  return FB_OK;
}

/* 1 if quat has unit length to 1e-3. */
static int fbi_quat_is_unit(const fb_real quat[4])
{
  const fb_real norm2 = quat[0] * quat[0] + fb_vec3_dot(quat + 1, quat + 1);
  return FB_FABS(norm2 - FB_R(1.0)) <= FB_R(2e-3);
}

#if FB_WITH_DETAIL
#define FBI_WORD_DEFLECTION "mode: has the largest share of the deflection [m], the sum over all modes, at most"
/* The mode with the largest share of the deflection; the first that is not a number. */
static int fbi_farthest(const fb_body *body, const fb_real *q)
{
  int most = 0;
  for (int a = 0; a < body->n; a++) {
    if (!fbi_is_finite(q + a, 1)) {
      return a;
    }
    most = body->reach[a] * FB_FABS(q[a]) > body->reach[most] * FB_FABS(q[most]) ? a : most;
  }
  return most;
}
#endif

/* Checks that a state is finite and within the deflection limit. */
static fb_status fbi_state_range(const fb_body *body, const fb_state *state)
{
  fb_real deflection = FB_R(0.0), momenta = FB_R(0.0);
  for (int a = 0; a < body->n; a++) {
    deflection += body->reach[a] * FB_FABS(state->q[a]);
    momenta += FB_FABS(state->pi[a]);
  }
  if (!fbi_vec3_is_finite(state->rho) || !fbi_vec3_is_finite(state->quat) || !fbi_vec3_is_finite(state->quat + 1) ||
      !fbi_vec3_is_finite(state->u) || !fbi_vec3_is_finite(state->L) || !fbi_vec3_is_finite(state->lost_rho) ||
      !(momenta <= FB_HUGE)) {
    return FB_ERR_NOT_FINITE;
  }
  if (!(deflection <= body->deflection_limit)) {
    return fbi_is_finite(state->q, body->n)
               ? FBI_REFUSE_AT(FB_ERR_RANGE, FBI_WORD_DEFLECTION, fbi_farthest(body, state->q), deflection,
                               body->deflection_limit, state->q[fbi_farthest(body, state->q)])
               : FBI_REFUSE(FB_ERR_NOT_FINITE, "mode: coordinate q of the state, finite", fbi_farthest(body, state->q),
                            FB_R(0.0), FB_R(0.0));
  }
  return FB_OK;
}

#if FB_SINGLE
/* Checks the Kahan terms of E11.22: finite, and for the attitude of round-off size, else they were not set. */
static fb_status fbi_lost_check(const fb_body *body, const fb_state *state)
{
  const fb_real *const turn = state->lost_quat;
  if (!fbi_is_finite(turn, 4) || !fbi_is_finite(state->lost_L, 3) || !fbi_is_finite(state->lost_h, 3) ||
      !fbi_is_finite(state->lost_q, body->n) || !fbi_is_finite(state->lost_pi, body->n)) {
    return FB_ERR_NOT_FINITE;
  }
  return turn[0] * turn[0] + fb_vec3_dot(turn + 1, turn + 1) < FB_R(1e-10) ? FB_OK : FB_ERR_VALUE;
}
#endif

FB_DEF fb_status fb_state_check(const fb_body *body, const fb_state *state)
{
  fb_status status;
  FBI_REQUIRE(body && state, FB_ERR_NULL);
  status = fbi_state_range(body, state);
#if FB_SINGLE
  status = status ? status : fbi_lost_check(body, state);
#endif
  if ((body->base == FB_BASE_PINNED || body->base == FB_BASE_HINGED) && !fbi_is_zero(state->u, 3)) {
    status = status ? status : FB_ERR_VALUE; /* O would leave its pin */
  }
  return status == FB_OK && !fbi_quat_is_unit(state->quat) ? FB_ERR_VALUE : status;
}

/* Momenta of known velocities V: (p, h) = S(q) V + Lambda(q) pb; S(q) goes to k.S. */
static void fbi_momenta(fbi_kinetics *k, const fb_body *body)
{
  fb_real elastic[6] = {0};
  fbi_S_eval(k->S, body, k->qx, body->n_run);
  fb_sym6_mul_vec6(k->ph, k->S, k->V);
  fbi_lambda_sub(elastic, body, k->qx, k->pb);
  for (int i = 0; i < 6; i++) {
    k->ph[i] -= elastic[i];
  }
}

/* pi = M q_dot + Lambda(q)^T V and (p, h) of the velocities V and q_dot. */
static void fbi_momenta_from(fbi_kinetics *k, fb_real *pi, const fb_body *body, const fb_real *q_dot)
{
  fb_real e[FB_MAX_MODES], unused[FB_MAX_MODES + 1] = {0}, zero[FB_MAX_MODES] = {0};
  fbi_zero(e, body->n);
  fbi_lambda_gradients(e, unused, body, k->V, k->qx, zero);
  fbi_mass_mul(pi, body, q_dot);
  for (int a = 0; a < body->n; a++) {
    pi[a] -= e[a];
  }
  fbi_mass_solve(k->Minv_pi, body, pi);
  k->pb = k->Minv_pi;
  fbi_momenta(k, body);
}

#if FB_WITH_FORMS
/* State of the second- or first-order form from pose, v, w and q_dot (in state.pi): velocities of a base that is not
   prescribed, and in state.pi q_dot or v_e (E8.28). */
static void fbi_form_state(fb_state *state, fbi_kinetics *k, const fb_body *body, const fb_real velocity[3])
{
  fb_real v[FB_MAX_MODES], unused[FB_MAX_MODES + 1] = {0};
  fbi_zero(state->u, 3);
  fbi_zero(state->L, 3);
  if (body->base != FB_BASE_PRESCRIBED) {
    fb_mat33_mul_vec3(state->u, k->R, velocity);
    fbi_copy(state->L, k->V + 3, 3);
  }
  if (body->form == FB_FORM_FIRST) {
    fbi_zero(k->e, body->n);
    fbi_lambda_linear_gradients(k->e, unused, body, k->V, k->qx, state->pi);
    fbi_mass_solve(v, body, k->e);
    for (int a = 0; a < body->n; a++) {
      state->pi[a] -= v[a];
    }
  }
}

/* (p, h) of the two forms; of the first-order form through the momentum form, pi = M v_e + M_re^T V. */
static void fbi_form_true_momenta(fbi_kinetics *k, const fb_body *body)
{
  fb_real pi[FB_MAX_MODES];
  if (body->form == FB_FORM_SECOND) {
    fbi_form_momenta(k, body);
    return;
  }
  fbi_zero(k->e, body->n);
  fbi_form_lambda_sub(k->e, body, k->V, k->qx);
  fbi_mass_solve(pi, body, k->e);
  for (int a = 0; a < body->n; a++) {
    k->Minv_pi[a] = k->pb[a] - pi[a];
  }
  k->pb = k->Minv_pi;
  fbi_momenta(k, body);
}
#endif

/* Velocities and the pose of a state: finite, attitude not zero, no motion that the base does not allow. */
static fb_status fbi_velocity_check(const fb_body *body, const fb_state *state, const fb_real v[3], const fb_real w[3],
                                    const fb_real *q_dot)
{
  fb_real quat[4], turning[3];
  if (!fbi_is_finite(v, 3) || !fbi_is_finite(w, 3) || !fbi_is_finite(q_dot, body->n) ||
      !fbi_is_finite(state->q, body->n) || !fbi_is_finite(state->quat, 4)) {
    return FB_ERR_NOT_FINITE;
  }
  fbi_copy(quat, state->quat, 4);
  fbi_vec3_copy(turning, w);
  fbi_turning_part(turning, body->base);
  if (fb_quat_normalize(quat) != FB_OK || (fbi_holds_origin(body->base) && fbi_vec3_norm(v) > FB_R(0.0)) ||
      (body->base == FB_BASE_HINGED && fbi_vec3_norm(turning) < fbi_vec3_norm(w))) {
    return FB_ERR_VALUE;
  }
  return FB_OK;
}

/* Momenta at the velocity v of O. A free body: u = R (v + (c_dot + w x c)/m) of the mass center, c the first moment of
   mass, and momenta at the velocity -p/m relative to it. Angular momentum L = R h, without the axes about which the
   base cannot rotate. */
static void fbi_momenta_set(fb_state *state, fbi_kinetics *k, const fb_body *body, const fb_real v[3],
                            const fb_real *q_dot)
{
  fbi_momenta_from(k, state->pi, body, q_dot);
  fb_mat33_mul_vec3(state->u, k->R, v);
  fbi_zero(state->L, 3);
  if (body->base == FB_BASE_FREE) {
    fb_real c[3], moved[3], own[3];
    for (int i = 0; i < 3; i++) {
      k->V[i] = -k->ph[i] / body->mass;
    }
    fbi_momenta_from(k, state->pi, body, q_dot);
    fbi_center_eval(c, body, state->q);
    fbi_center_rate(moved, body, state->q, q_dot);
    fbi_vec3_add_cross(moved, k->V + 3, c);
    fb_mat33_mul_vec3(own, k->R, moved);
    fbi_vec3_add(state->u, FB_R(1.0) / body->mass, own);
  }
  if (body->base != FB_BASE_PRESCRIBED) {
    fbi_turning_part(k->ph + 3, body->base);
    fb_mat33_mul_vec3(state->L, k->R, k->ph + 3);
    fbi_copy(state->h, k->ph + 3, 3);
  }
}

FB_DEF fb_status fb_state_from_velocity(const fb_body *body, fb_state *state, const fb_real v[3], const fb_real w[3],
                                        const fb_real *q_dot)
{
  const fb_real zero[FB_MAX_MODES] = {0}, *rates = q_dot ? q_dot : zero;
  fb_state out;
  fbi_kinetics k;
  fb_status status;
  FBI_REQUIRE(body && state && v && w, FB_ERR_NULL);
  status = fbi_velocity_check(body, state, v, w, rates);
  if (status != FB_OK) {
    return status;
  }

  /* R, (1, q), V = (0, w) */
  out = *state; /* its quaternion as it is, unscaled */
  fb_quat_to_mat33(k.R, state->quat);
  k.qx[0] = FB_R(1.0);
  fbi_copy(k.qx + 1, state->q, body->n);
  fbi_zero(k.V, 3);
  fbi_copy(k.V + 3, w, 3);

  /* other forms: velocities are the state */
#if FB_WITH_FORMS
  if (body->form != FB_FORM_MOMENTUM) {
    fbi_copy(out.pi, rates, body->n);
    fbi_form_state(&out, &k, body, v);
    *state = out;
    return FB_OK;
  }
#endif

  /* momenta; no compensation terms */
  fbi_momenta_set(&out, &k, body, v, rates);
  fbi_zero(out.lost_u, 3);
#if FB_SINGLE
  fbi_zero(out.lost_L, 3);
  fbi_zero(out.lost_pi, body->n);
  fbi_zero(out.lost_h, 3);
#endif
  if (!fbi_state_is_finite(&out, body->n)) {
    return FB_ERR_NOT_FINITE;
  }
  *state = out;
  return FB_OK;
}

/* Reactions of the base: S V_dot - y in the rows that it constrains, else zero. */
static void fbi_reactions(fb_motion *m, const fb_body *body, const fb_real S[21], const fb_real V_dot[6],
                          const fb_real y[6])
{
  fb_real SV[6];
  fb_sym6_mul_vec6(SV, S, V_dot);
  for (int i = 0; i < 3; i++) {
    const int turns = body->base == FB_BASE_PINNED || (body->base == FB_BASE_HINGED && i == 2);
    m->reaction_force[i] = body->base == FB_BASE_FREE ? FB_R(0.0) : SV[i] - y[i];
    m->reaction_torque[i] = body->base == FB_BASE_FREE || turns ? FB_R(0.0) : SV[3 + i] - y[3 + i];
  }
}

#if FB_WITH_FORMS
/* Accelerations of the second- and first-order forms: the rates of the state, to which the first-order form adds the
   rate of M^-1 q_b Ups_b^T w in q_dot. */
static void fbi_form_motion(fb_motion *m, fbi_kinetics *k, const fb_body *body, const fb_state *rate)
{
  fb_real xd[FB_MAX_MODES + 1], y[6], unused[FB_MAX_MODES + 1] = {0};
  fbi_copy(xd + 1, rate->q, body->n);
  fbi_copy(m->acceleration, k->V_dot, 3);
  fbi_copy(m->w_dot, k->V_dot + 3, 3);
  fbi_zero(k->e, body->n);
  if (body->form == FB_FORM_FIRST) {
    fbi_lambda_linear_gradients(k->e, unused, body, k->V, xd, k->pb);
    fbi_lambda_linear_gradients(k->e, unused, body, k->V_dot, k->qx, k->pb);
  }
  fbi_mass_solve(m->q_ddot, body, k->e);
  for (int a = 0; a < body->n; a++) {
    m->q_ddot[a] += rate->pi[a];
  }
  fbi_copy(y, k->y, 6);
  for (int t = 0; t < body->n_lambda_value; t++) {
    const fb_lambda_term *term = &body->lambda[t];
    y[term->i] += term->c * k->qx[term->a] * rate->pi[term->b];
  }
  fbi_reactions(m, body, k->S, k->V_dot, y);
}
#endif

/* Acceleration of O from that of the mass center, body axes: a - (w_dot x c + w x (w x c + 2 c_dot) + c_ddot)/m, xd the
   rate of (1, q). */
static void fbi_origin_acceleration(fb_real out[3], const fb_real a[3], const fb_body *body, const fbi_kinetics *k,
                                    const fb_real *xd, const fb_motion *m)
{
  fb_real c[3], c_dot[3], c_ddot[3], turn[3];
  fbi_center_eval(c, body, k->qx + 1);
  fbi_center_rate(c_ddot, body, k->qx + 1, m->q_ddot);
  fbi_center_rate(c_dot, body, k->qx + 1, xd + 1);
  const fb_lambda_term *t = body->lambda + body->n_lambda_constant;
  for (const fb_lambda_term *end = t + body->n_linear; t < end; t++) {
    c_ddot[t->i] -= t->c * xd[t->a] * xd[t->b + 1];
  }
  fb_vec3_cross(turn, k->V + 3, c);
  fbi_vec3_add(turn, FB_R(2.0), c_dot);
  fbi_vec3_add_cross(c_ddot, m->w_dot, c);
  fbi_vec3_add_cross(c_ddot, k->V + 3, turn);
  for (int i = 0; i < 3; i++) {
    out[i] = a[i] - c_ddot[i] / body->mass;
  }
}

/* [E8.19] Accelerations from the rates of the state: differentiate E8.13 and E8.17,
   S V_dot = d/dt(p, h) - S_dot V - Lambda_dot pb - Lambda pb_dot, all relative to the frame of the momenta,
   q_ddot = M^-1 (pi_dot - Lambda^T V_dot - Lambda_dot^T V);
   in rows that the base constrains V_dot is given and the first line yields the reaction (force, torque) instead.
   Source: THEORY.md 8.5, acceleration form.  Fails: S(q) not positive definite.
   Test: accelerations_agree_with_a_particle_model, reactions_balance_the_momentum. */
static fb_status fbi_accelerations(fb_motion *m, fbi_kinetics *k, const fb_body *body, const fb_state *rate,
                                   const fb_input *input)
{
  const int n = body->n;
  fb_real xd[FB_MAX_MODES + 1], pb_dot[FB_MAX_MODES], y[6], V_dot[6], turn[6], SV[6];

  /* y: right-hand side of the rigid-body rows */
  xd[0] = FB_R(0.0);
  fbi_copy(xd + 1, rate->q, n);
  fbi_mass_solve(pb_dot, body, rate->pi);
  fbi_momenta(k, body);
  fbi_S_rate(k->dS, body, k->qx, xd);
  fbi_turning(turn, k->V, k->ph);
  fb_sym6_mul_vec6(SV, k->dS, k->V);
  for (int i = 0; i < 6; i++) {
    y[i] = k->fg[i] - turn[i] - SV[i];
  }
  fbi_lambda_linear_sub(y, body, xd, k->pb);
  fbi_lambda_sub(y, body, k->qx, pb_dot);

  /* V_dot by solution or prescribed, then the reactions */
  if (fbi_base_solve(V_dot, body->base, k->S, y) != FB_OK) {
    return FB_ERR_RANGE;
  }
  fbi_zero(m->acceleration, 3);
  if (body->base == FB_BASE_PRESCRIBED && input) { /* V = v - R^T u: V_dot = v_dot + w x R^T u */
    fbi_given_acceleration(m->acceleration, input);
    fb_vec3_cross(V_dot, k->V, k->V + 3);
    fbi_vec3_add(V_dot, FB_R(1.0), m->acceleration);
    fbi_copy(V_dot + 3, input->w_dot, 3);
  }
  fbi_reactions(m, body, k->S, V_dot, y);

  /* q_ddot */
  fbi_copy(k->e, rate->pi, n);
  fbi_lambda_gradients(k->e, k->x, body, V_dot, k->qx, k->pb); /* k.x: scratch by now */
  fbi_lambda_linear_gradients(k->e, k->x, body, k->V, xd, k->pb);
  fbi_mass_solve(m->q_ddot, body, k->e);

  /* w_dot, acceleration of O */
  fbi_copy(m->w_dot, V_dot + 3, 3);
  if (body->base == FB_BASE_FREE) {
    fb_real a[3];
    fb_mat33_mulT_vec3(a, k->R, rate->u);
    fbi_origin_acceleration(m->acceleration, a, body, k, xd, m);
  }
  return FB_OK;
}

FB_DEF fb_status fb_body_motion_eval(const fb_body *body, fb_motion *motion, const fb_state *state,
                                     const fb_input *input)
{
  fbi_kinetics k;
  fb_state rate, at;
  fb_motion out;
  fb_real velocity[3];
  fb_status status;
  FBI_REQUIRE(body && motion && state, FB_ERR_NULL);

  /* rates of the state */
  status = fbi_input_check(body, input);
  fbi_state_enter(&at, k.R, body, state);
  if (status == FB_OK) {
    status = fbi_rates(&rate, &k, body, &at, input);
  }
  if (status != FB_OK) {
    return status;
  }

  /* velocities */
  memset(&out, 0, sizeof out);
  fbi_origin_velocity(velocity, &k, body, &at, rate.q);
  fb_mat33_mulT_vec3(out.v, k.R, velocity);
  if (body->base == FB_BASE_PRESCRIBED) { /* exactly as prescribed */
    fbi_copy(out.v, input ? input->v : fbi_origin, 3);
  }
  fbi_copy(out.w, k.V + 3, 3);
  fbi_copy(out.q_dot, rate.q, body->n);

  /* accelerations */
#if FB_WITH_FORMS
  if (body->form != FB_FORM_MOMENTUM) {
    fbi_form_motion(&out, &k, body, &rate);
  }
#endif
  if (fbi_form(body) == 0) {
    status = fbi_accelerations(&out, &k, body, &rate, input);
  }

  /* result, if finite */
  if (status == FB_OK &&
      (!fbi_is_finite(out.v, 3) || !fbi_is_finite(out.w, 3) || !fbi_is_finite(out.acceleration, 3) ||
       !fbi_is_finite(out.w_dot, 3) || !fbi_is_finite(out.q_dot, body->n) || !fbi_is_finite(out.q_ddot, body->n))) {
    status = FB_ERR_NOT_FINITE;
  }
  if (status == FB_OK) {
    *motion = out;
  }
  return status;
}

/* [E8.20] Motion of a node, s = r + u:
   velocity v + w x s + u_dot,  u_dot = J_u q_dot,
   acceleration a + w_dot x s + w x (w x s) + 2 w x u_dot + J_u q_ddot + Ju_dot q_dot, a that of O,
   angular rate w + J_phi q_dot,  its rate w_dot + J_phi q_ddot + w x J_phi q_dot + Jphi_dot q_dot (E8.30).
   Source: kinematics of a moving frame.  Fails: no such node.  Test: node_kinematics_match_finite_differences. */
#define FBI_NODE_MOTION ((int)(sizeof(fb_node_motion) / sizeof(fb_real))) /* all its members are reals */
static void fbi_node_motion(fb_node_motion *out, const fb_body *body, const fb_state *state, const fb_motion *motion,
                            int node)
{
  fbi_node_field f;
  fb_real R[9], turn[4], s[3], ud[3] = {0}, pd[3] = {0}, ws[3], a[3], alpha[3], vel[3], rate[3], u_dd[3], turn_dd[3];
  fbi_node_eval(&f, body, &body->node[node], state->q);
  fb_quat_to_mat33(R, state->quat);

  /* node in the body frame: u_dot, J_phi q_dot, and the elastic part of the accelerations */
  fbi_copy(a, motion->acceleration, 3);
  fbi_copy(alpha, motion->w_dot, 3);
  for (int k = 0; k < body->n; k++) {
    fbi_vec3_add(ud, motion->q_dot[k], f.Ju + 3 * k);
    fbi_vec3_add(pd, motion->q_dot[k], f.Jphi + 3 * k);
    fbi_vec3_add(a, motion->q_ddot[k], f.Ju + 3 * k);
    fbi_vec3_add(alpha, motion->q_ddot[k], f.Jphi + 3 * k);
  }
  fbi_node_convection(u_dd, turn_dd, &f, body, &body->node[node], motion->q_dot);
  fbi_vec3_add(a, FB_R(1.0), u_dd);
  fbi_vec3_add(alpha, FB_R(1.0), turn_dd);

  /* motion of the frame; ws = w x s, then w x s + 2 u_dot */
  fbi_copy(s, body->node[node].r, 3);
  fbi_vec3_add(s, FB_R(1.0), f.u);
  fb_vec3_cross(ws, motion->w, s);
  for (int i = 0; i < 3; i++) {
    vel[i] = motion->v[i] + ws[i] + ud[i];
    rate[i] = motion->w[i] + pd[i];
    ws[i] += FB_R(2.0) * ud[i];
  }
  fbi_vec3_add_cross(a, motion->w_dot, s);
  fbi_vec3_add_cross(a, motion->w, ws);
  fbi_vec3_add_cross(alpha, motion->w, pd);

  /* inertial axes */
  fb_mat33_mul_vec3(out->position, R, s);
  fbi_vec3_add(out->position, FB_R(1.0), state->rho);
  fbi_node_quat(turn, &f);
  fb_quat_mul(out->quat, state->quat, turn);
  fb_mat33_mul_vec3(out->velocity, R, vel);
  fb_mat33_mul_vec3(out->angular_rate, R, rate);
  fb_mat33_mul_vec3(out->acceleration, R, a);
  fb_mat33_mul_vec3(out->angular_acceleration, R, alpha);
  fbi_copy(out->displacement, f.u, 3);
  fb_quat_to_rotvec(out->rotation, turn);
}

FB_DEF fb_status fb_body_node_motion_eval(const fb_body *body, fb_node_motion *out, const fb_state *state,
                                          const fb_motion *motion, int node)
{
  fb_node_motion found;
  fb_real all[FBI_NODE_MOTION];
  FBI_REQUIRE(body && out && state && motion, FB_ERR_NULL);
  FBI_REQUIRE(node >= 0 && node < body->n_node, FB_ERR_CAPACITY);
  fbi_node_motion(&found, body, state, motion, node);
  memcpy(all, &found, sizeof all);
  if (!fbi_is_finite(all, FBI_NODE_MOTION)) {
    return FB_ERR_NOT_FINITE;
  }
  *out = found;
  return FB_OK;
}

static fb_real fbi_kinetic_energy(fbi_kinetics *k, const fb_body *body, const fb_state *state)
{
  fb_real SV[6], T = FB_R(0.0);
#if FB_WITH_FORMS
  if (body->form != FB_FORM_MOMENTUM) { /* 1/2 V^T (p, h) + 1/2 pb^T (M pb + Lambda^T V) */
    fbi_form_momenta(k, body);
    fbi_sparse_eval(k->e, NULL, FB_R(-1.0), &body->M, k->pb, body->n);
    fbi_form_lambda_sub(k->e, body, k->V, k->qx);
    for (int a = 0; a < body->n; a++) {
      T -= FB_R(0.5) * k->pb[a] * k->e[a];
    }
    return T + FB_R(0.5) * fbi_vec6_dot(k->ph, k->V);
  }
#endif
  fbi_S_eval(k->S, body, k->qx, body->n_run);
  fb_sym6_mul_vec6(SV, k->S, k->V);
  for (int a = 0; a < body->n; a++) {
    T += FB_R(0.5) * state->pi[a] * k->pb[a];
  }
  return T + FB_R(0.5) * fbi_vec6_dot(SV, k->V);
}

static int fbi_energy_is_finite(const fb_energy *energy)
{
  const fb_real part[3] = {energy->kinetic, energy->strain, energy->gravity};
  return fbi_is_finite(part, 3);
}

/* energy += strain energy and potential of gravity; overwrites k.e and k.x. */
static void fbi_potential_add(fb_energy *energy, fbi_kinetics *k, const fb_body *body, const fb_real *q,
                              const fb_real rho[3])
{
  fbi_sparse_eval(k->e, NULL, FB_R(0.5), &body->K, q, body->n);
  for (int a = 0; a < body->n; a++) {
    energy->strain += q[a] * k->e[a];
  }
#if FB_WITH_NONLINEAR_STRAIN
  if (fbi_has(body->effects, FB_EFFECT_NONLINEAR_STRAIN)) {
    energy->strain += fbi_strain_energy(body, q);
  }
#endif
#if FB_WITH_GRAVITY
  {
    fb_real c[3], moment[3];
    fbi_pull_eval(c, k->x, body, k->qx, body->gravity);
    fb_mat33_mul_vec3(moment, k->R, c);
    fbi_vec3_add(moment, body->mass, rho);
    energy->gravity -= fb_vec3_dot(moment, body->gravity);
  }
#endif
  (void)rho;
}

/* Velocity u of the frame to which k.V is relative, inertial axes. */
static void fbi_frame_velocity(fb_real u[3], const fbi_kinetics *k, const fb_body *body, const fb_state *state,
                               const fb_input *input)
{
  fbi_copy(u, state->u, 3);
  if (fbi_form(body) != 0 && body->base == FB_BASE_PRESCRIBED) {
    fb_mat33_mul_vec3(u, k->R, input ? input->v : fbi_origin);
  }
}

/* (p, h) relative to that frame, from the velocities; a free body in momentum form has them from fbi_velocity. */
static void fbi_true_momenta(fbi_kinetics *k, const fb_body *body)
{
#if FB_WITH_FORMS
  if (body->form != FB_FORM_MOMENTUM) {
    fbi_form_true_momenta(k, body);
    return;
  }
#endif
  if (body->base != FB_BASE_FREE) {
    fbi_momenta(k, body);
  }
}

/* [E8.21] T = 1/2 m u.u + u.R p + 1/2 V^T S V + 1/2 pi^T M^-1 pi (square completed in q_dot), u the velocity of the
   frame, U = 1/2 q^T K q, gravity -m g.rho - g.R c(q).
   Source: THEORY.md 8.2, 8.4.  Fails: as the rates.
   Test: momenta_agree_with_a_particle_model, tumbling_conserves_momentum_and_energy. */
FB_DEF fb_status fb_body_energy_eval(const fb_body *body, fb_energy *energy, const fb_state *state,
                                     const fb_input *input)
{
  fbi_kinetics k;
  fb_energy out;
  fb_state at;
  fb_real u[3], p[3];
  fb_status status;
  FBI_REQUIRE(body && energy && state, FB_ERR_NULL);

  /* velocities */
  fbi_state_enter(&at, k.R, body, state);
  status = fbi_velocity(&k, body, &at, input);
  if (status != FB_OK) {
    return status;
  }

  /* kinetic energy in the frame, then of its motion: u.(R p + 1/2 m u) */
  out.kinetic = fbi_kinetic_energy(&k, body, &at);
  fbi_true_momenta(&k, body);
  fbi_frame_velocity(u, &k, body, &at, input);
  fb_mat33_mul_vec3(p, k.R, k.ph);
  fbi_vec3_add(p, FB_R(0.5) * body->mass, u);
  out.kinetic += fb_vec3_dot(u, p);

  /* potentials */
  out.strain = FB_R(0.0);
  out.gravity = FB_R(0.0);
  fbi_potential_add(&out, &k, body, state->q, state->rho);
  if (!fbi_energy_is_finite(&out)) {
    return FB_ERR_NOT_FINITE;
  }
  *energy = out;
  return FB_OK;
}

/* Linear momentum R p + m u and, about the inertial origin, angular momentum R h + R c x u + rho x (R p + m u). */
FB_DEF fb_status fb_body_momentum_eval(const fb_body *body, fb_momentum *momentum, const fb_state *state,
                                       const fb_input *input)
{
  fbi_kinetics k;
  fb_momentum out;
  fb_state at;
  fb_real u[3], c[3], arm[3];
  fb_status status;
  FBI_REQUIRE(body && momentum && state, FB_ERR_NULL);

  /* velocities, (p, h) */
  fbi_state_enter(&at, k.R, body, state);
  status = fbi_velocity(&k, body, &at, input);
  if (status != FB_OK) {
    return status;
  }
  fbi_true_momenta(&k, body);
  fbi_frame_velocity(u, &k, body, &at, input);

  /* linear; angular about O, in the frame */
  fb_mat33_mul_vec3(out.linear, k.R, k.ph);
  fbi_vec3_add(out.linear, body->mass, u);
  fb_mat33_mul_vec3(out.angular, k.R, k.ph + 3);
  if (fbi_is_flying(body)) {
    fbi_copy(out.angular, at.L, 3);
  }

  /* angular about the inertial origin */
  fbi_center_eval(c, body, at.q);
  fb_mat33_mul_vec3(arm, k.R, c);
  fbi_vec3_add_cross(out.angular, arm, u);
  fbi_vec3_add_cross(out.angular, at.rho, out.linear);
  if (!fbi_is_finite(out.linear, 3) || !fbi_is_finite(out.angular, 3)) {
    return FB_ERR_NOT_FINITE;
  }
  *momentum = out;
  return FB_OK;
}

/* ---- checks of a model whose memory may be corrupted */

static int fbi_is_flag(int value)
{
  return value == 0 || value == 1;
}

static int fbi_is_within(int n, int most)
{
  return n >= 0 && n <= most;
}

static int fbi_sparse_is_sound(const fb_sparse *m, int n)
{
  int sound = fbi_is_within(m->n_term, FBI_MAX_PAIRS) && fbi_is_finite(m->diagonal, n);
  for (int k = 0; sound && k < m->n_term; k++) {
    const fb_pair_term *t = &m->term[k];
    sound = t->a < n && t->b < t->a && fbi_is_finite(&t->c, 1);
  }
  return sound;
}

/* Checks the terms of Lambda: the constant ones, then row by row those linear in q (fbi_lambda_list). */
static int fbi_lambda_is_sound(const fb_body *body)
{
  int row = 0,
      sound = fbi_is_within(body->n_lambda, FBI_MAX_LAMBDA) && fbi_is_within(body->n_lambda_constant, body->n_lambda) &&
              fbi_is_within(body->n_linear_constant, body->n_lambda_constant) &&
              fbi_is_within(body->n_linear, body->n_lambda - body->n_lambda_constant) && fbi_is_within(body->n_row, 6);
  for (int k = 0; sound && k < body->n_row; k++) { /* no row is empty */
    sound = body->lambda_row[k].i < 6 &&
            body->lambda_row[k].end > (k > 0 ? body->lambda_row[k - 1].end : body->n_lambda_constant);
  }
  for (int k = 0; sound && k < body->n_lambda; k++) {
    const fb_lambda_term *t = &body->lambda[k];
    const int constant = k < body->n_lambda_constant;
    row += !constant && row < body->n_row && k >= body->lambda_row[row].end;
    sound = fbi_is_finite(&t->c, 1) && t->b < body->n && (constant ? t->a == 0 : t->a >= 1 && t->a <= body->n) &&
            (constant ? (k < body->n_linear_constant) == (t->i < 3) && t->i < 6
                      : row < body->n_row && t->i == body->lambda_row[row].i &&
                            (k < body->n_lambda_constant + body->n_linear) == (t->i < 3));
  }
  return sound && (body->n_row == 0 || (row == body->n_row - 1 && body->lambda_row[row].end == body->n_lambda));
}

/* Checks the terms of S: runs of consecutive pairs. */
static int fbi_S_is_sound(const fb_body *body)
{
  int terms = 0, sound = fbi_is_within(body->n_S, FBI_MAX_S) && fbi_is_within(body->n_run, FBI_MAX_RUNS) &&
                         fbi_is_within(body->n_pair, FBI_MAX_PAIRS_S) && fbi_is_finite(body->S, body->n_S);
  for (int k = 0; sound && k < body->n_run; k++) {
    const fb_S_run *r = &body->run[k];
    terms += r->n;
    sound = r->i < 21 && r->pair + r->n <= body->n_pair;
  }
  for (int k = 0; sound && k < body->n_pair; k++) {
    sound = body->pair[k].a <= body->n && body->pair[k].b <= body->pair[k].a;
  }
  return sound && (fbi_form(body) == 0 ? terms == body->n_S : terms <= body->n_S); /* truncation leaves runs out */
}

#if FB_WITH_FORMS
static int fbi_form_is_sound(const fb_body *body)
{
  int sound = fbi_is_choice((int)body->form, (int)FB_FORM_COUNT - 1) &&
              fbi_is_choice((int)body->stiffness_torque, (int)FB_TORQUE_COUNT - 1) &&
              fbi_is_within(body->torque_degree, 3) && fbi_is_within(body->n_run_value, body->n_run) &&
              fbi_is_within(body->n_lambda_value, body->n_lambda) && fbi_is_within(body->n_gam, 9 * body->n) &&
              fbi_is_within(body->n_torque, FBI_MAX_TORQUE) && fbi_is_finite(body->M_rr, 21);
  for (int k = 0; sound && k < body->n_gam + body->n_torque; k++) {
    const int is_gam = k < body->n_gam;
    const fb_lambda_term *t = is_gam ? &body->gam[k] : &body->torque[k - body->n_gam];
    sound = fbi_is_finite(&t->c, 1) && t->i < (is_gam ? 9 : 3) && t->a >= 1 && t->a <= body->n && t->b < body->n;
  }
  return sound;
}
#endif

#if FB_WITH_NONLINEAR_STRAIN
static int fbi_strain_is_sound(const fb_body *body)
{
  const fb_real number[3] = {body->quartic, body->limit_slope, body->limit_tension};
  int sound = fbi_is_within(body->n_strain, FBI_MAX_STRAINS) && body->n_strain % 4 == 0 && fbi_is_finite(number, 3) &&
              fbi_is_within(body->n_strain_row, 3 * body->n) && fbi_is_finite(body->strain_weight, body->n_strain);
  for (int k = 0; sound && k < body->n_strain_row; k++) {
    const fb_strain_row *r = &body->strain_row[k];
    sound = r->axis < 3 && r->a < body->n && fbi_is_finite(r->slope, body->n_strain);
  }
  return sound;
}
#endif

static int fbi_matrices_are_sound(const fb_body *body)
{
  int sound = fbi_sparse_is_sound(&body->M, body->n) && fbi_sparse_is_sound(&body->Minv, body->n) &&
              fbi_sparse_is_sound(&body->K, body->n);
#if FB_WITH_DAMPING
  sound = sound && fbi_sparse_is_sound(&body->C, body->n);
#endif
  for (int a = 0; sound && a < body->n; a++) {
    sound = body->K.diagonal[a] >= FB_R(0.0) && body->reach[a] >= FB_R(0.0) &&
            (!body->unit_mass || body->M.diagonal[a] > FB_R(0.0));
  }
  return sound;
}

/* Checks the scalars and S_0, which is positive definite for a free body, and that its inverse is finite. */
static int fbi_rigid_is_sound(const fb_body *body)
{
  const fb_real number[8] = {body->mass,          body->deflection_limit, body->recoil,     body->gyration,
                             body->limit_elastic, body->limit_damping,    body->limit_spin, body->limit_acceleration};
  const fb_real unit[6] = {FB_R(1.0)};
  fb_real x[6];
  for (int k = 0; k < 8; k++) {
    if (!(number[k] >= FB_R(0.0) && number[k] <= FB_HUGE)) {
      return 0;
    }
  }
  return fbi_is_finite(body->c, 3) && fbi_is_finite(body->reach, body->n) && fbi_is_finite(body->S0, 21) &&
         fbi_is_finite(body->S0_inverse, 36) &&
         (body->base != FB_BASE_FREE || fbi_sym6_solve(x, body->S0, unit) == FB_OK);
}

FB_DEF fb_status fb_body_check(const fb_body *body)
{
  int sound;
  FBI_REQUIRE(body, FB_ERR_NULL);

  /* counts first: the other checks read by them */
  if (!fbi_is_within(body->n, FB_MAX_MODES) || body->n_node < 1 || body->n_node > FB_MAX_NODES) {
    return FB_ERR_CAPACITY;
  }

  /* values */
  sound = !fbi_is_excluded(body->effects) && fbi_is_choice((int)body->base, (int)FB_BASE_COUNT - 1) &&
          fbi_is_flag(body->unit_mass) && fbi_is_flag(body->constant_S) && fbi_is_flag(body->allow_long_step) &&
          fbi_rigid_is_sound(body) && fbi_matrices_are_sound(body) && fbi_lambda_is_sound(body) && fbi_S_is_sound(body);
#if FB_WITH_FORMS
  sound = sound && fbi_form_is_sound(body);
#endif
#if FB_WITH_NONLINEAR_STRAIN
  sound = sound && fbi_strain_is_sound(body);
#endif
#if FB_WITH_GRAVITY
  sound = sound && fbi_is_finite(body->gravity, 3);
#endif
  for (int k = 0; sound && k < body->n_node; k++) {
    sound = fbi_node_is_finite(&body->node[k], body->n);
  }
  return sound ? FB_OK : FB_ERR_VALUE;
}

/* ---- check word */

/* [E8.40] CRC-32 of integers and reals, four bytes at a time, low byte first: polynomial x^32 + x^26 + x^23 + x^22
   + x^16 + x^12 + x^11 + x^10 + x^8 + x^7 + x^5 + x^4 + x^2 + x + 1, reflected (0xEDB88320).
   Source: IEEE 802.3, 3.2.9.  Cost: 32 shifts a word.  Fails: never.
   Test: the_check_word_sees_every_flipped_bit, the_check_word_sees_every_form. */
typedef char fbi_crc_takes_four_bytes[sizeof(unsigned) == 4 && sizeof(float) == 4 && sizeof(double) == 8 ? 1 : -1];

static FBI_NOINLINE unsigned fbi_crc_word(unsigned crc, unsigned word)
{
  crc ^= word;
  for (int k = 0; k < 32; k++) {
    crc = crc >> 1 ^ (0xEDB88320u & (0u - (crc & 1u)));
  }
  return crc;
}

static FBI_NOINLINE unsigned fbi_crc_ints(unsigned crc, const int *x, int n)
{
  for (int i = 0; i < n; i++) {
    crc = fbi_crc_word(crc, (unsigned)x[i]);
  }
  return crc;
}

/* Reals enter in the precision of the target, which may differ from the program's. FBI_NOINLINE: smaller code. */
static FBI_NOINLINE unsigned fbi_crc_reals(unsigned crc, const fb_real *x, int n, int single)
{
  for (int i = 0; i < n; i++) {
    if (single) {
      const float value = (float)x[i];
      unsigned bits;
      memcpy(&bits, &value, sizeof value);
      crc = fbi_crc_word(crc, bits);
    } else {
      const double value = (double)x[i];
      unsigned long long bits;
      memcpy(&bits, &value, sizeof value);
      crc = fbi_crc_word(fbi_crc_word(crc, (unsigned)(bits & 0xFFFFFFFFu)), (unsigned)(bits >> 32));
    }
  }
  return crc;
}

static unsigned fbi_crc_sparse(unsigned crc, const fb_sparse *m, int n, int single)
{
  crc = fbi_crc_reals(fbi_crc_word(crc, (unsigned)m->n_term), m->diagonal, n, single);
  for (int k = 0; k < m->n_term; k++) {
    crc = fbi_crc_word(fbi_crc_reals(crc, &m->term[k].c, 1, single), m->term[k].a | (unsigned)m->term[k].b << 16);
  }
  return crc;
}

static unsigned fbi_crc_lambda(unsigned crc, const fb_lambda_term *list, int n, int single)
{
  for (int k = 0; k < n; k++) {
    crc = fbi_crc_word(fbi_crc_reals(crc, &list[k].c, 1, single), list[k].i | (unsigned)list[k].a << 16);
    crc = fbi_crc_word(crc, list[k].b);
  }
  return crc;
}

static unsigned fbi_crc_terms(unsigned crc, const fb_body *body, int single)
{
  for (int k = 0; k < 6; k++) {
    crc = fbi_crc_word(crc, body->lambda_row[k].i | (unsigned)body->lambda_row[k].end << 16);
  }
  crc = fbi_crc_lambda(crc, body->lambda, body->n_lambda, single);
  crc = fbi_crc_reals(crc, body->S, body->n_S, single);
  for (int k = 0; k < body->n_run; k++) {
    crc = fbi_crc_word(fbi_crc_word(crc, body->run[k].i | (unsigned)body->run[k].pair << 16), body->run[k].n);
  }
  for (int k = 0; k < body->n_pair; k++) {
    crc = fbi_crc_word(crc, body->pair[k].a | (unsigned)body->pair[k].b << 16);
  }
  return crc;
}

static unsigned fbi_crc_nodes(unsigned crc, const fb_body *body, int single)
{
  const int n = body->n;
  for (int k = 0; k < body->n_node; k++) {
    const fb_node *node = &body->node[k];
    crc = fbi_crc_reals(crc, node->r, 3, single);
    crc = fbi_crc_reals(fbi_crc_reals(crc, node->psi, 3 * n, single), node->theta, 3 * n, single);
#if FBI_WITH_QUADRATIC
    if (fbi_has(body->effects, FBI_QUADRATIC_EFFECTS)) {
      crc = fbi_crc_reals(crc, node->chi, 3 * n * (n + 1) / 2, single);
      crc = fbi_crc_reals(crc, node->chi_theta, 3 * n * (n + 1) / 2, single);
    }
#endif
  }
  return crc;
}

#if FB_WITH_FORMS
static unsigned fbi_crc_form(unsigned crc, const fb_body *body, int single)
{
  const int whole[] = {(int)body->form,   (int)body->stiffness_torque, body->torque_degree,
                       body->n_run_value, body->n_lambda_value,        body->n_gam,
                       body->n_torque};
  crc = fbi_crc_ints(crc, whole, (int)(sizeof whole / sizeof *whole));
  crc = fbi_crc_reals(crc, body->M_rr, 21, single);
  crc = fbi_crc_lambda(crc, body->gam, body->n_gam, single);
  return fbi_crc_lambda(crc, body->torque, body->n_torque, single);
}
#endif

#if FB_WITH_NONLINEAR_STRAIN
static unsigned fbi_crc_strain(unsigned crc, const fb_body *body, int single)
{
  const fb_real number[3] = {body->quartic, body->limit_slope, body->limit_tension};
  crc = fbi_crc_word(fbi_crc_word(crc, (unsigned)body->n_strain), (unsigned)body->n_strain_row);
  crc = fbi_crc_reals(fbi_crc_reals(crc, number, 3, single), body->strain_weight, body->n_strain, single);
  for (int k = 0; k < body->n_strain_row; k++) {
    const fb_strain_row *r = &body->strain_row[k];
    crc = fbi_crc_word(fbi_crc_reals(crc, r->slope, body->n_strain, single), r->axis | (unsigned)r->a << 16);
  }
  return crc;
}
#endif

/* Data of optional effects and forms; a body without them adds nothing. */
static unsigned fbi_crc_further(unsigned crc, const fb_body *body, int single)
{
#if FB_WITH_DAMPING
  if (fbi_has(body->effects, FB_EFFECT_DAMPING)) {
    crc = fbi_crc_sparse(crc, &body->C, body->n, single);
  }
#endif
#if FB_WITH_GRAVITY
  if (fbi_has(body->effects, FB_EFFECT_GRAVITY)) {
    crc = fbi_crc_reals(crc, body->gravity, 3, single);
  }
#endif
#if FB_WITH_FORMS
  if (fbi_form(body) != 0) {
    crc = fbi_crc_form(crc, body, single);
  }
#endif
#if FB_WITH_NONLINEAR_STRAIN
  if (fbi_has(body->effects, FB_EFFECT_NONLINEAR_STRAIN)) {
    crc = fbi_crc_strain(crc, body, single);
  }
#endif
  (void)body, (void)single; /* all of it may be removed at compile time */
  return crc;
}

static unsigned fbi_body_crc(const fb_body *body, int single)
{
  const int whole[] = {body->n,
                       body->n_node,
                       (int)body->effects,
                       (int)body->base,
                       body->n_lambda,
                       body->n_lambda_constant,
                       body->n_linear,
                       body->n_linear_constant,
                       body->n_row,
                       body->n_S,
                       body->n_run,
                       body->n_pair,
                       body->unit_mass,
                       body->constant_S,
                       body->allow_long_step};
  const fb_real number[8] = {body->mass,          body->deflection_limit, body->recoil,     body->gyration,
                             body->limit_elastic, body->limit_damping,    body->limit_spin, body->limit_acceleration};
  unsigned crc = fbi_crc_ints(0xFFFFFFFFu, whole, (int)(sizeof whole / sizeof *whole));
  crc = fbi_crc_reals(fbi_crc_reals(crc, number, 8, single), body->c, 3, single);
  crc = fbi_crc_reals(crc, body->reach, body->n, single);
  crc = fbi_crc_reals(fbi_crc_reals(crc, body->S0, 21, single), body->S0_inverse, 36, single);
  crc = fbi_crc_sparse(fbi_crc_sparse(crc, &body->M, body->n, single), &body->Minv, body->n, single);
  crc = fbi_crc_sparse(crc, &body->K, body->n, single);
  crc = fbi_crc_further(crc, body, single);
  return ~fbi_crc_nodes(fbi_crc_terms(crc, body, single), body, single);
}

/* 1 if every count is within its table, so that the CRC reads nothing beyond. */
static int fbi_counts_are_sound(const fb_body *body)
{
  int sound = fbi_is_within(body->n, FB_MAX_MODES) && fbi_is_within(body->n_node, FB_MAX_NODES) &&
              fbi_is_within(body->M.n_term, FBI_MAX_PAIRS) && fbi_is_within(body->Minv.n_term, FBI_MAX_PAIRS) &&
              fbi_is_within(body->K.n_term, FBI_MAX_PAIRS) && fbi_is_within(body->n_lambda, FBI_MAX_LAMBDA) &&
              fbi_is_within(body->n_S, FBI_MAX_S) && fbi_is_within(body->n_run, FBI_MAX_RUNS) &&
              fbi_is_within(body->n_pair, FBI_MAX_PAIRS_S);
#if FB_WITH_DAMPING
  sound = sound && fbi_is_within(body->C.n_term, FBI_MAX_PAIRS);
#endif
#if FB_WITH_FORMS
  sound = sound && fbi_is_within(body->n_gam, 9 * FB_MAX_MODES) && fbi_is_within(body->n_torque, FBI_MAX_TORQUE);
#endif
#if FB_WITH_NONLINEAR_STRAIN
  sound =
      sound && fbi_is_within(body->n_strain, FBI_MAX_STRAINS) && fbi_is_within(body->n_strain_row, 3 * FB_MAX_MODES);
#endif
  return sound;
}

FB_DEF unsigned fb_body_crc(const fb_body *body)
{
  FBI_REQUIRE(body, 0);
  return fbi_counts_are_sound(body) ? fbi_body_crc(body, FB_SINGLE) : 0;
}

/* ---- sensors */

/* [E9.20] Specific force R^T (a - g) and angular rate R^T w in the section's axes.
   Source: definition of an accelerometer.  Test: joint_forces_carry_what_hangs_on_them. */
FB_DEF void fb_imu_eval(fb_imu *imu, const fb_node_motion *node, const fb_real *gravity)
{
  FBI_REQUIRE(imu && node, );
  fb_real R[9], a[3];
  fb_quat_to_mat33(R, node->quat);
  for (int i = 0; i < 3; i++) {
    a[i] = node->acceleration[i] - (gravity ? gravity[i] : FB_R(0.0));
  }
  fb_mat33_mulT_vec3(imu->specific_force, R, a);
  fb_mat33_mulT_vec3(imu->angular_rate, R, node->angular_rate);
}

#if FB_WITH_SYSTEM
/* ---------------------------------------------------------------------------------------------------------------
   RUN >>system: bodies on joints: trees, loops, constraint rows (uses config, status, vec3, rotation, solve, body) */

/* ---- joints */

/* Kinematics of each kind of joint, in the order of fb_joint_kind.
   n_axis: number of axes.
   angle, slide, tilt: the axis that rotates about z, that translates along z, that rotates about the x axis as the
   angle has rotated it; -1: none. The free and the spherical joint, which have no scalar coordinate for each axis,
   have none of them.
   pitched: 1 if the angle also translates along z, by the pitch.
   holds: the directions of its constraint rows, 0..2 translations along x, y, z, FBI_SQUARE(i, j) the right angle
   between axis i of the parent and axis j of the child; -1 ends the list.
   Pose, twists, coordinates, efforts and rows follow from these. With a tilt the twist of the angle depends on the
   coordinates: A_dot of the universal joint (fbi_joint_turn, fbi_momentum_rate, fbi_bias_acceleration) takes the angle
   as axis 0 and the tilt as axis 1. */
#define FBI_SQUARE(i, j) (3 + 3 * (i) + (j))
typedef struct fbi_joint_traits {
  int n_axis, angle, slide, tilt, pitched, holds[7];
} fbi_joint_traits;

static const fbi_joint_traits fbi_joint_table[] = {
    {6, -1, -1, -1, 0, {-1}},                                                                /* FREE */
    {0, -1, -1, -1, 0, {0, 1, 2, FBI_SQUARE(0, 1), FBI_SQUARE(1, 2), FBI_SQUARE(2, 0), -1}}, /* RIGID */
    {1, 0, -1, -1, 0, {0, 1, 2, FBI_SQUARE(0, 2), FBI_SQUARE(1, 2), -1}},                    /* REVOLUTE */
    {1, -1, 0, -1, 0, {0, 1, FBI_SQUARE(0, 1), FBI_SQUARE(1, 2), FBI_SQUARE(2, 0), -1}},     /* PRISMATIC */
    {2, 0, 1, -1, 0, {0, 1, FBI_SQUARE(0, 2), FBI_SQUARE(1, 2), -1}},                        /* CYLINDRICAL */
    {1, 0, -1, -1, 1, {0, 1, FBI_SQUARE(0, 2), FBI_SQUARE(1, 2), -1}},                       /* SCREW */
    {2, 0, -1, 1, 0, {0, 1, 2, FBI_SQUARE(2, 0), -1}},                                       /* UNIVERSAL */
    {3, -1, -1, -1, 0, {0, 1, 2, -1}},                                                       /* SPHERICAL */
};
typedef char fbi_joint_table_is_whole[sizeof fbi_joint_table / sizeof fbi_joint_table[0] == FB_JOINT_COUNT ? 1 : -1];

static const fbi_joint_traits *fbi_traits(const fb_joint *joint)
{
  return &fbi_joint_table[(int)joint->kind];
}

/* Are its coordinates an attitude? Then all its axes have one mode. */
static int fbi_is_ball(fb_joint_kind kind)
{
  return kind == FB_JOINT_FREE || kind == FB_JOINT_SPHERICAL;
}

/* Joint that connects body k to its parent. With multipliers all joints are constraints and every body is free. */
static const fb_joint *fbi_link_joint(const fb_system *system, const fb_system_work *w, int k)
{
  return w->kept ? &system->free : &system->joint[k];
}

/* Is joint j enforced by multipliers ("kept" as constraint rows)? Loop joints always are. */
static int fbi_is_kept(const fb_system *system, const fb_system_work *w, int j)
{
  return j >= system->n_body || (w->kept && system->joint[j].kind != FB_JOINT_FREE);
}

/* [E9.1] Unit twist of an axis a of the joint, child's axes about its origin: a rotation about a through the point d
   moves the origin by d x a, a translation by a. turns, slides: the factors of the two.
   Source: kinematics.  Shapes: A 6.  Test: every_joint_moves_as_it_should. */
static void fbi_axis_twist(fb_real A[6], const fb_joint *joint, const fb_real axis[3], fb_real turns, fb_real slides)
{
  fb_real a[3];
  fb_mat33_mul_vec3(a, joint->child_axes, axis);
  fb_vec3_cross(A, joint->child_position, a);
  for (int i = 0; i < 3; i++) {
    A[i] = turns * A[i] + slides * a[i];
    A[3 + i] = turns * a[i];
  }
}

/* Is quat an attitude, or all zero (not given)? */
static int fbi_is_attitude(const fb_real quat[4])
{
  fb_real copy[4];
  fbi_copy(copy, quat, 4);
  return quat[0] == FB_R(0.0) && fbi_vec3_norm(quat + 1) == FB_R(0.0) ? 1 : fb_quat_normalize(copy) == FB_OK;
}

/* Do the modes of a body move one of its nodes? */
static int fbi_node_moves(const fb_body *body, int node)
{
  fb_real size = FB_R(0.0);
  for (int i = 0; i < 3 * body->n; i++) {
    size += FB_FABS(body->node[node].psi[i]) + FB_FABS(body->node[node].theta[i]);
  }
  return size > FB_R(0.0);
}

/* ---- positions */

/* C = axes rotated by the joint coordinates x; slide [m]: translation along z of the axes. Universal joint: also the
   twists of its axes, of which the first depends on the second angle, and the derivative A_dot by that angle. */
static void fbi_joint_turn(fb_real C[9], fb_real *slide, fbi_link_work *L, const fb_joint *joint, const fb_real axes[9],
                           const fb_link_state *x)
{
  const fbi_joint_traits *is = fbi_traits(joint);

  /* translation along z */
  *slide = is->slide >= 0 ? x->x[is->slide] : is->pitched ? joint->pitch * x->x[is->angle] : FB_R(0.0);

  /* rotation: by a quaternion, none, or by an angle about z */
  if (fbi_is_ball(joint->kind)) {
    fb_real turn[9];
    fb_quat_to_mat33(turn, x->quat);
    fb_mat33_mul(C, axes, turn);
  } else if (is->angle < 0) {
    fbi_mat33_copy(C, axes);
  } else {
    const fb_real c = FB_COS(x->x[is->angle]), s = FB_SIN(x->x[is->angle]);
    FBI_UNROLL
    for (int i = 0; i < 9; i += 3) {
      C[i] = c * axes[i] + s * axes[i + 1];
      C[i + 1] = c * axes[i + 1] - s * axes[i];
      C[i + 2] = axes[i + 2];
    }
  }

  /* universal: then by the second angle about the rotated x; first axis seen from the child */
  if (is->tilt >= 0) {
    const fb_real c = FB_COS(x->x[is->tilt]), s = FB_SIN(x->x[is->tilt]);
    const fb_real first[3] = {FB_R(0.0), s, c}, rate[3] = {FB_R(0.0), c, -s};
    for (int i = 0; i < 9; i += 3) {
      const fb_real y = C[i + 1], z = C[i + 2];
      C[i + 1] = c * y + s * z;
      C[i + 2] = c * z - s * y;
    }
    fbi_axis_twist(L->turned, joint, first, FB_R(1.0), FB_R(0.0));
    fbi_vec6_copy(L->turned + 6, joint->A + 6);
    L->A = L->turned;
    fbi_axis_twist(L->A_dot, joint, rate, FB_R(1.0), FB_R(0.0));
  }
}

/* Joint frame in the parent's axes: origin, and axes, which it returns: the joint's own, or `turned` where modes move
   the node, at L->n, with which the frame is displaced and rotated. */
static const fb_real *fbi_parent_frame(fb_real origin[3], fb_real turned[9], fbi_link_work *L, const fb_joint *joint,
                                       const fbi_link_work *parent, const fb_body *on)
{
  const fb_node *node;
  fb_real quat[4], R[9];
  if (!joint->moves || !parent) {
    fbi_vec3_copy(origin, joint->position);
    return joint->axes;
  }
  node = &on->node[joint->parent_node];
  fbi_node_eval(&L->node, on, node, parent->k.qx + 1);
  fbi_node_quat(quat, &L->node);
  fb_quat_to_mat33(R, quat);
  fb_mat33_mul(turned, R, joint->axes);
  fb_mat33_mul_vec3(origin, R, joint->position);
  for (int i = 0; i < 3; i++) {
    L->n[i] = node->r[i] + L->node.u[i];
    origin[i] += L->n[i];
  }
  return turned;
}

/* Child in the parent's axes, from the joint frame there: axes L->C = J child_axes^T, J the joint frame rotated by the
   coordinates, and position L->s = origin + slide z - C child_position. */
static void fbi_child_place(fbi_link_work *L, const fb_joint *joint, const fb_real origin[3], const fb_real axes[9],
                            const fb_link_state *x)
{
  fb_real J[9], slide;
  fbi_joint_turn(J, &slide, L, joint, axes, x);
  if (joint->turned) {
    for (int i = 0; i < 9; i++) {
      L->C[i] = fb_vec3_dot(J + i / 3 * 3, joint->child_axes + i % 3 * 3);
    }
  } else {
    fbi_mat33_copy(L->C, J);
  }
  fb_mat33_mul_vec3(L->s, L->C, joint->child_position);
  FBI_UNROLL
  for (int i = 0; i < 3; i++) {
    L->s[i] = origin[i] + slide * axes[3 * i + 2] - L->s[i];
  }
}

/* [E9.2] Pose of a body from that of its parent: the node (E8.14), the joint frame on it, the joint's coordinates, the
   child's frame: R = R_p C,  rho = rho_p + R_p s.
   Source: kinematics of a chain; [H] 3.1.  Cost: 150 flops, a sine and a cosine an angle.  Fails: never.
   Test: every_joint_moves_as_it_should. */
static void fbi_link_place(fbi_link_work *L, const fb_joint *joint, const fbi_link_work *parent, const fb_body *on,
                           const fb_link_state *x)
{
  const fb_real *axes;
  fb_real turned[9], origin[3];
  if (joint->kind == FB_JOINT_FREE) {
    fb_quat_to_mat33(L->k.R, x->quat); /* rho: fbi_root_place */
    return;
  }

  /* C, s; arm from the node to the child's origin */
  axes = fbi_parent_frame(origin, turned, L, joint, parent, on);
  fbi_child_place(L, joint, origin, axes, x);
  fbi_vec3_copy(L->arm, L->s);
  if (joint->moves) {
    fbi_vec3_add(L->arm, -FB_R(1.0), L->n);
  }

  /* R, rho: on the ground as they are, else by the parent's pose */
  if (!parent) {
    fbi_mat33_copy(L->k.R, L->C);
    fbi_vec3_copy(L->rho, L->s);
    return;
  }
  fb_mat33_mul(L->k.R, parent->k.R, L->C);
  fb_mat33_mul_vec3(L->rho, parent->k.R, L->s);
  fbi_vec3_add(L->rho, FB_R(1.0), parent->rho);
}

static fbi_link_work *fbi_parent(fb_system_work *w, const fb_joint *joint)
{
  return joint->parent >= 0 ? &w->link[joint->parent] : NULL;
}

static const fb_body *fbi_model(const fb_system *system, const fb_body *body, int k)
{
  return &body[system->model[k]];
}

/* [E9.21] Frame of a tree: an inertial frame; its velocity u, constant within a step, is in the state of the tree's
   free root. Momenta of the tree are relative to it, and positions rho of its bodies are measured from its origin, the
   position of the root at the start of the step. The equations of motion are the same in every such frame; positions
   and velocities relative to the ground or to another tree are not. Free trees that constraints tie share one frame.
   Source: Galilean invariance.  Test: flight_speed_changes_nothing. */
static void fbi_root_place(fb_system_work *w, const fb_system *system, const fb_joint *joint, int k,
                           const fb_link_state *x, const fb_link_state *start)
{
  fbi_link_work *L = &w->link[k];

  /* not free: the frame of the root, which on the ground is at rest in the origin */
  if (joint->kind != FB_JOINT_FREE) {
    L->root = joint->parent >= 0 ? w->link[joint->parent].root : k;
    if (L->root == k) {
      fbi_vec3_zero(L->origin);
      fbi_vec3_zero(L->frame);
    }
    return;
  }

  /* free: a tree of its own, or of the first free root if constraints tie the trees */
  L->root = k;
  for (int i = 0; i < k && system->tied && L->root == k; i++) {
    L->root = fbi_link_joint(system, w, i)->kind == FB_JOINT_FREE ? i : k;
  }

  /* origin and velocity of the frame; position in it */
  if (L->root == k) {
    fbi_vec3_copy(L->origin, start->x);
    fbi_vec3_copy(L->frame, start->u);
    fbi_vec3_copy(L->rho, x->lost_x); /* from its start */
  } else {
    const fb_real *origin = w->link[L->root].origin;
    FBI_UNROLL
    for (int i = 0; i < 3; i++) {
      L->rho[i] = (start->x[i] - origin[i]) + x->lost_x[i];
    }
  }
}

/* Coordinate i, from the ground, of a body's point at rho in its tree's frame. */
static fb_real fbi_true_position(const fb_system_work *w, int link, const fb_real rho[3], int i)
{
  const fbi_link_work *root = &w->link[w->link[link].root];
  return root->origin[i] + (w->clock * root->frame[i] + rho[i]);
}

/* y += s times the position of the frame of link b relative to that of link a (FB_GROUND: at rest in the origin), or
   (moves) its velocity. */
static void fbi_frames_apart_add(fb_real y[3], fb_real s, const fb_system_work *w, int a, int b, int moves)
{
  const fbi_link_work *from = a >= 0 ? &w->link[w->link[a].root] : NULL;
  const fbi_link_work *to = b >= 0 ? &w->link[w->link[b].root] : NULL;
  if (from == to) {
    return;
  }
  for (int i = 0; i < 3; i++) {
    const fb_real u = (to ? to->frame[i] : FB_R(0.0)) - (from ? from->frame[i] : FB_R(0.0));
    const fb_real x = (to ? to->origin[i] : FB_R(0.0)) - (from ? from->origin[i] : FB_R(0.0));
    y[i] += s * (moves ? u : x + w->clock * u);
  }
}

/* Poses of all bodies, and the joint, model and parent of each. modes: the state whose axis modes and frames count. */
static void fbi_links_place(fb_system_work *w, const fb_system *system, const fb_body *body,
                            const fb_system_state *state, const fb_system_state *modes)
{
  for (int k = 0; k < system->n_body; k++) {
    const fb_body *model = fbi_model(system, body, k);
    const fb_joint *joint = fbi_link_joint(system, w, k);
    fbi_link_work *L = &w->link[k];

    /* (1, q) */
    L->k.qx[0] = FB_R(1.0);
    for (int a = 0; a < model->n; a++) {
      L->k.qx[a + 1] = state->link[k].q[a];
    }

    /* axis modes; a body whose joint is enforced by multipliers is free */
    if (fbi_is_kept(system, w, k)) {
      L->mode[0] = L->mode[1] = L->mode[2] = FB_AXIS_FREE;
    } else {
      L->mode[0] = modes->mode[k][0];
      L->mode[1] = modes->mode[k][1];
      L->mode[2] = modes->mode[k][2];
    }

    /* what belongs to the link */
    L->joint = joint;
    L->model = model;
    L->parent = fbi_parent(w, joint);
    L->coupled = !w->kept && system->coupled[k];
    L->has_speeds = 1;
    L->A = joint->A;

    /* frame of the tree, pose in it */
    fbi_root_place(w, system, joint, k, &state->link[k], &modes->link[k]);
    fbi_link_place(L, joint, L->parent, joint->parent >= 0 ? fbi_model(system, body, joint->parent) : NULL,
                   &state->link[k]);
  }
}

/* ---- trees: M u = p */

/* Mode of axis i of a joint; the six axes of a free joint share one. */
static fb_axis_mode fbi_axis_mode(const fbi_link_work *L, const fb_joint *joint, int i)
{
  return L->mode[joint->kind == FB_JOINT_FREE ? 0 : i];
}

/* Y = C X C^T */
static void fbi_mat33_turn(fb_real Y[9], const fb_real C[9], const fb_real X[9])
{
  fb_real T[9];
  fb_mat33_mul(T, C, X);
  FBI_UNROLL
  for (int i = 0; i < 9; i += 3) {
    Y[i] = fb_vec3_dot(T + i, C);
    Y[i + 1] = fb_vec3_dot(T + i, C + 3);
    Y[i + 2] = fb_vec3_dot(T + i, C + 6);
  }
}

/* The same for symmetric X. */
static void fbi_sym3_turn(fb_real Y[9], const fb_real C[9], const fb_real X[9])
{
  fb_real T[9];
  fb_mat33_mul(T, C, X);
  Y[0] = fb_vec3_dot(T, C);
  Y[1] = Y[3] = fb_vec3_dot(T, C + 3);
  Y[2] = Y[6] = fb_vec3_dot(T, C + 6);
  Y[4] = fb_vec3_dot(T + 3, C + 3);
  Y[5] = Y[7] = fb_vec3_dot(T + 3, C + 6);
  Y[8] = fb_vec3_dot(T + 6, C + 6);
}

/* T += X^T S X for the velocity transform X V = (v + w x arm, w): the 6x6 inertia S = [A B; B^T D] about another
   point. */
static void fbi_sym6_shift_add(fb_real T[21], const fb_real A[9], const fb_real B[9], const fb_real D[9],
                               const fb_real arm[3])
{
  fb_real BA[9], sB[9], sBA[9]; /* B - A arm^, arm^ B, arm^ (B - A arm^) */

  /* B - A arm^ */
  FBI_UNROLL
  for (int i = 0; i < 3; i++) {
    fb_real row[3];
    fb_vec3_cross(row, A + 3 * i, arm); /* row of A arm^ is a x arm */
    FBI_UNROLL
    for (int j = 0; j < 3; j++) {
      BA[3 * i + j] = B[3 * i + j] - row[j];
    }
  }

  /* arm^ B and arm^ (B - A arm^) */
  FBI_UNROLL
  for (int j = 0; j < 3; j++) {
    const fb_real x[3] = {B[j], B[3 + j], B[6 + j]}, y[3] = {BA[j], BA[3 + j], BA[6 + j]};
    fb_real p[3], q[3];
    fb_vec3_cross(p, arm, x);
    fb_vec3_cross(q, arm, y);
    FBI_UNROLL
    for (int i = 0; i < 3; i++) {
      sB[3 * i + j] = p[i];
      sBA[3 * i + j] = q[i];
    }
  }

  /* blocks v-v, v-w, w-w */
  T[0] += A[0];
  T[1] += A[1];
  T[2] += A[2];
  T[6] += A[4];
  T[7] += A[5];
  T[11] += A[8];
  FBI_UNROLL
  for (int j = 0; j < 3; j++) {
    T[3 + j] += BA[j];
    T[8 + j] += BA[3 + j];
    T[12 + j] += BA[6 + j];
  }
  T[15] += D[0] + sB[0] + sBA[0];
  T[16] += D[1] + sB[1] + sBA[3];
  T[17] += D[2] + sB[2] + sBA[6];
  T[18] += D[4] + sB[4] + sBA[4];
  T[19] += D[5] + sB[5] + sBA[7];
  T[20] += D[8] + sB[8] + sBA[8];
}

/* Blocks of a packed symmetric 6x6: A = v-v, B = v-w, D = w-w. */
static void fbi_sym6_blocks(fb_real A[9], fb_real B[9], fb_real D[9], const fb_real S[21])
{
  A[0] = S[0];
  A[1] = A[3] = S[1];
  A[2] = A[6] = S[2];
  A[4] = S[6];
  A[5] = A[7] = S[7];
  A[8] = S[11];
  B[0] = S[3];
  B[1] = S[4];
  B[2] = S[5];
  B[3] = S[8];
  B[4] = S[9];
  B[5] = S[10];
  B[6] = S[12];
  B[7] = S[13];
  B[8] = S[14];
  D[0] = S[15];
  D[1] = D[3] = S[16];
  D[2] = D[6] = S[17];
  D[4] = S[18];
  D[5] = D[7] = S[19];
  D[8] = S[20];
}

/* [E9.3] Inertia of a child as seen by the parent: rotated by C, shifted by arm, added to T.
   Source: congruence.  Cost: 350 flops.  Test: the_three_methods_agree. */
static void fbi_sym6_to_parent_add(fb_real T[21], const fb_real S[21], const fb_real C[9], const fb_real arm[3])
{
  fb_real a[9], b[9], d[9], A[9], B[9], D[9];
  fbi_sym6_blocks(a, b, d, S);
  fbi_sym3_turn(A, C, a);
  fbi_mat33_turn(B, C, b);
  fbi_sym3_turn(D, C, d);
  fbi_sym6_shift_add(T, A, B, D, arm);
}

/* y += momentum or load x of a child in the parent's axes, about the node that carries it (the parent's origin where
   modes do not move the node). */
static void fbi_to_parent_add(fb_real y[6], const fbi_link_work *L, const fb_real x[6])
{
  fb_real p[3], h[3];
  fb_mat33_mul_vec3(p, L->C, x);
  fb_mat33_mul_vec3(h, L->C, x + 3);
  fbi_vec3_add(y, FB_R(1.0), p);
  fbi_vec3_add(y + 3, FB_R(1.0), h);
  fbi_vec3_add_cross(y + 3, L->arm, p);
}

/* Velocity of the node that carries a child (the parent's origin where modes do not move it), parent's axes. */
static void fbi_node_velocity(fb_real V[6], const fbi_link_work *L, const fb_joint *joint, const fb_body *on,
                              const fb_real parent[6], const fb_real *q_dot)
{
  fbi_vec6_copy(V, parent);
  if (joint->moves) {
    fbi_vec3_add_cross(V, parent + 3, L->n);
    for (int a = 0; a < on->n; a++) {
      fbi_vec3_add(V, q_dot[a], L->node.Ju + 3 * a);
      fbi_vec3_add(V + 3, q_dot[a], L->node.Jphi + 3 * a);
    }
  }
}

/* V of a child at zero joint speeds from the velocity of the node: (C^T (v + w x arm), C^T w). */
static void fbi_from_node(fb_real V[6], const fbi_link_work *L, const fb_real node[6])
{
  fb_real v[3];
  fbi_vec3_copy(v, node);
  fbi_vec3_add_cross(v, node + 3, L->arm);
  fb_mat33_mulT_vec3(V, L->C, v);
  fb_mat33_mulT_vec3(V + 3, L->C, node + 3);
}

/* Elastic block of the articulated-body inertia, for bodies whose nodes carry children or whose modes are integrated
   implicitly: E = (1 + heavy) M + g C + g^2 K_t, X = Lambda^T (6 per mode), S = M_rr = S + Lambda M^-1 Lambda^T.
   heavy: extra modal mass while loops are closed. */
static FBI_NOINLINE void fbi_link_open(fbi_link_work *L, const fb_body *body, fb_real g, fb_real heavy)
{
  fb_real sum[21];
  const int n = body->n;

  /* E = (1 + heavy) M + g C + g^2 K_t */
  fbi_zero(L->E, n * n);
  if (g > FB_R(0.0)) {
    fbi_sparse_add(L->E, FB_R(1.0), &body->K, n);
#if FB_WITH_NONLINEAR_STRAIN
    if (fbi_has(body->effects, FB_EFFECT_NONLINEAR_STRAIN)) {
      fbi_slopes_eval(L->k.slope, body, L->k.qx + 1);
      fbi_strain_tangent_add(L->E, body, L->k.slope);
    }
#endif
    for (int i = 0; i < n * n; i++) {
      L->E[i] *= g * g;
    }
#if FB_WITH_DAMPING
    if (fbi_has(body->effects, FB_EFFECT_DAMPING)) {
      fbi_sparse_add(L->E, g, &body->C, n);
    }
#endif
  }
  fbi_sparse_add(L->E, FB_R(1.0) + heavy, &body->M, n);

  /* X = Lambda^T */
  fbi_zero(L->X, 6 * n);
  for (const fb_lambda_term *t = body->lambda; t < body->lambda + body->n_lambda; t++) {
    L->X[6 * t->b + t->i] -= t->c * L->k.qx[t->a];
  }

  /* S + Lambda M^-1 Lambda^T */
  fbi_zero(sum, 21);
  for (int a = 0; a < n && body->unit_mass; a++) {
    fbi_sym6_rank1_sub(sum, -FB_R(1.0), L->X + 6 * a);
  }
  for (int i = 0; i < 6 && !body->unit_mass; i++) {
    fb_real row[FB_MAX_MODES], y[FB_MAX_MODES];
    for (int a = 0; a < n; a++) {
      row[a] = L->X[6 * a + i];
    }
    fbi_mass_solve(y, body, row);
    for (int j = i; j < 6; j++) {
      for (int a = 0; a < n; a++) {
        sum[fb_sym6_index(i, j)] += y[a] * L->X[6 * a + j];
      }
    }
  }
  fbi_row_sub(L->S, -FB_R(1.0), sum, 21); /* the sum first: S is rounded once */
}

/* Adds a child of inertia S on a node that modes move: E += J^T I J (the lower triangle, which is factored),
   X += J^T I V, S += V^T I V with I the child's inertia about the node and V = (v + w x n, w) the node's velocity by
   the parent's. */
static FBI_NOINLINE void fbi_link_carry(fbi_link_work *P, const fbi_link_work *L, const fb_real S[21], int n)
{
  fb_real I[21], A[9], B[9], D[9], column[6];
  fbi_zero(I, 21);
  fbi_sym6_to_parent_add(I, S, L->C, L->arm);
  for (int a = 0; a < n; a++) {
    const fb_real *u = L->node.Ju + 3 * a, *t = L->node.Jphi + 3 * a;
    const fb_real J[6] = {u[0], u[1], u[2], t[0], t[1], t[2]};
    fb_sym6_mul_vec6(column, I, J);
    for (int b = 0; b <= a; b++) {
      P->E[a * n + b] += fb_vec3_dot(column, L->node.Ju + 3 * b) + fb_vec3_dot(column + 3, L->node.Jphi + 3 * b);
    }
    fbi_vec3_add_cross(column + 3, L->n, column);
    fbi_vec6_add(P->X + 6 * a, FB_R(1.0), column);
  }
  fbi_sym6_blocks(A, B, D, I);
  fbi_sym6_shift_add(P->S, A, B, D, L->n);
}

/* Eliminates the modes: E = L L^T, X = L^-1 X, S -= X^T X. */
static FBI_NOINLINE fb_status fbi_link_close(fbi_link_work *L, int n)
{
  if (fb_chol_factor(L->E, n) != FB_OK) {
    return FB_ERR_RANGE;
  }
  for (int a = 0; a < n; a++) {
    const fb_real *row = L->E + a * n;
    fb_real x[6];
    fbi_vec6_copy(x, L->X + 6 * a);
    for (int b = 0; b < a; b++) {
      fbi_vec6_add(x, -row[b], L->X + 6 * b);
    }
    for (int i = 0; i < 6; i++) {
      L->X[6 * a + i] = x[i] / row[a];
    }
    fbi_sym6_rank1_sub(L->S, FB_R(1.0), L->X + 6 * a);
  }
  return FB_OK;
}

/* [E9.4] Articulated-body inertia: each free axis is eliminated, S -= U U^T / D, U = S A, D = A.U + g c + g^2 k. Axes
   of one joint are eliminated one after the other, as if massless bodies were between them. An axis moves no inertia
   where D is round-off, of its own summands or of the largest inertia that an axis further out has eliminated.
   Source: block elimination of M u = p from the tips; [FE] 7.
   Cost: 80 flops an axis.  Fails: no inertia.  Test: the_three_methods_agree. */
static fb_status fbi_link_release(fbi_link_work *L, const fb_joint *joint, fb_real g)
{
  const fb_real own[6] = {L->S[0], L->S[6], L->S[11], L->S[15], L->S[18], L->S[20]};

  /* free joint: solved by fbi_free_solve; here only whether there is inertia */
  if (joint->kind == FB_JOINT_FREE) {
    const fb_real mass = fbi_smaller(FB_FABS(own[0]), fbi_smaller(FB_FABS(own[1]), FB_FABS(own[2])));
    const fb_real moment = fbi_smaller(FB_FABS(own[3]), fbi_smaller(FB_FABS(own[4]), FB_FABS(own[5])));
    const int nothing = mass < FB_R(16.0) * FB_EPSILON * L->mass || moment < FB_R(16.0) * FB_EPSILON * L->moment;
    return L->mode[0] == FB_AXIS_FREE && nothing ? FB_ERR_UNDETERMINED : FB_OK;
  }

  /* prescribed axes: U by the inertia before elimination */
  for (int i = 0; i < joint->n_axis; i++) {
    if (L->mode[i] == FB_AXIS_PRESCRIBED) {
      fb_sym6_mul_vec6(L->U + 6 * i, L->S, L->A + 6 * i);
    }
  }

  /* free axes */
  const fb_real mass = L->mass, moment = L->moment; /* eliminated further out */
  for (int i = 0; i < joint->n_axis; i++) {
    const fb_real *A = L->A + 6 * i;
    fb_real *U = L->U + 6 * i, D = g * joint->damping[i] + g * g * joint->stiffness[i], reference = D;
    if (L->mode[i] != FB_AXIS_FREE) {
      continue;
    }
    fb_sym6_mul_vec6(U, L->S, A);
    D += fbi_vec6_dot(A, U);
    reference += A[0] * A[0] * (own[0] + mass) + A[1] * A[1] * (own[1] + mass) + A[2] * A[2] * (own[2] + mass) +
                 A[3] * A[3] * (own[3] + moment) + A[4] * A[4] * (own[4] + moment) + A[5] * A[5] * (own[5] + moment);
    if (!(D > FB_R(16.0) * FB_EPSILON * reference)) { /* well below zero: deflection beyond the model's range */
      return D < -FB_R(1e-3) * reference ? FB_ERR_RANGE : FB_ERR_UNDETERMINED;
    }
    L->D[i] = FB_R(1.0) / D;
    L->mass = fbi_larger(L->mass, L->D[i] * fb_vec3_dot(U, U));
    L->moment = fbi_larger(L->moment, L->D[i] * fb_vec3_dot(U + 3, U + 3));
    fbi_sym6_rank1_sub(L->S, L->D[i], U);
  }
  return FB_OK;
}

/* Factors M + g C + g^2 K of a tree from the tips to the ground; w->joint names the joint on failure. */
static FBI_FLATTEN fb_status fbi_tree_factor(fb_system_work *w, const fb_system *system, fb_real g)
{
  /* each body by itself; open: its modes are eliminated together with its joint */
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *L = &w->link[k];
    const fb_body *model = L->model;
    if (model->constant_S) {
      fbi_sym6_copy(L->S, model->S0);
    } else {
      fbi_S_eval(L->S, model, L->k.qx, model->n_run);
    }
    L->open = model->n > 0 && (L->coupled || g + w->heavy > FB_R(0.0));
    if (L->open) {
      fbi_link_open(L, model, g, w->heavy);
    }
    L->mass = L->moment = FB_R(0.0);
  }

  /* from the tips: modes and joint eliminated, the rest added to the parent */
  for (int k = system->n_body - 1; k >= 0; k--) {
    fbi_link_work *L = &w->link[k], *parent = L->parent;
    const fb_joint *joint = L->joint;
    fb_status status = L->open ? fbi_link_close(L, L->model->n) : FB_OK;
    status = status == FB_OK ? fbi_link_release(L, joint, g) : status;
    if (status != FB_OK) {
      w->joint = k;
      return status;
    }

    /* largest eliminated inertia, whose round-off S contains */
    if (parent) {
      parent->mass = fbi_larger(parent->mass, L->mass);
      parent->moment = fbi_larger(parent->moment, L->moment + L->mass * fb_vec3_dot(L->s, L->s));
    }
    if (parent && joint->moves) {
      fbi_link_carry(parent, L, L->S, parent->model->n);
    } else if (parent) {
      fbi_sym6_to_parent_add(parent->S, L->S, L->C, L->arm);
    }
  }
  return FB_OK;
}

/* Forward elimination in one body: b is the momentum that the body and its subtree transmit to the joint, e the
   right-hand side of the modes. */
static void fbi_link_in(fbi_link_work *L, const fb_joint *joint, const fb_body *body)
{
  const int n = body->n;

  /* modes */
  if (L->open) {
    fb_real b[6];
    fbi_vec6_copy(b, L->b);
    fbi_chol_forward(L->e, L->E, L->e, n);
    for (int a = 0; a < n; a++) {
      fbi_vec6_add(b, L->e[a], L->X + 6 * a);
    }
    fbi_vec6_copy(L->b, b);
  } else if (n > 0) {
    fb_real own[6] = {0}, e[FB_MAX_MODES];
    fbi_copy(e, L->e, n);
    fbi_mass_solve(L->e, body, e);
    fbi_lambda_sub(own, body, L->k.qx, L->e);
    fbi_vec6_add(L->b, -FB_R(1.0), own);
  }

  /* joint: prescribed axes, then free ones */
  if (joint->kind == FB_JOINT_FREE) {
    return;
  }
  for (int i = 0; i < joint->n_axis; i++) {
    if (L->mode[i] == FB_AXIS_PRESCRIBED) {
      fbi_vec6_add(L->b, L->p[i], L->U + 6 * i);
    }
  }
  for (int i = 0; i < joint->n_axis; i++) {
    if (L->mode[i] == FB_AXIS_FREE) {
      L->r[i] = L->D[i] * (L->p[i] - fbi_vec6_dot(L->A + 6 * i, L->b));
      fbi_vec6_add(L->b, L->r[i], L->U + 6 * i);
    }
  }
}

/* V = S^-1 y of a free joint. The elimination of joints further out leaves round-off in all directions of S; pivots in
   fixed order resolve only the square root of that. Where a pivot is below it, E3.2 decides. */
static fb_status fbi_free_solve(fb_real V[6], const fbi_link_work *L, const fb_real y[6])
{
  const fb_real tol = 64 * FB_EPSILON, root = FB_SINGLE ? FB_R(4e-3) : FB_R(2e-7);
  fb_real reference[6];
  fbi_sym6_reference(reference, L->S, L->mass, L->moment);
  if (fbi_sym6_solve_above(V, L->S, y, reference, root) == FB_OK) {
    return FB_OK;
  }
  return fbi_sym6_stands_out(L->S, 0, reference, tol) ? fbi_sym6_solve(V, L->S, y) : FB_ERR_SINGULAR;
}

/* V of a body on a free joint: S V = p - b, or prescribed; G = S V. */
static fb_status fbi_free_out(fb_real V[6], fbi_link_work *L, int n)
{
  if (L->mode[0] == FB_AXIS_FREE) {
    fbi_vec6_copy(L->G, L->p);
    fbi_vec6_add(L->G, -FB_R(1.0), L->b);
    if (fbi_free_solve(V, L, L->G) != FB_OK) {
      return !fbi_is_finite(L->S, 21) ? FB_ERR_NOT_FINITE : n > 0 ? FB_ERR_RANGE : FB_ERR_UNDETERMINED;
    }
  } else {
    if (L->mode[0] == FB_AXIS_PRESCRIBED) {
      fbi_vec6_copy(V, L->p);
    }
    fb_sym6_mul_vec6(L->G, L->S, V);
  }
  fbi_vec6_copy(L->u, V);
  return FB_OK;
}

/* G = S V, and V += A u of the axes of any other joint: the eliminated ones from the last to the first,
   u_i = r_i - D_i U_i.V, with S A_i = 0 in the S that they leave; then the prescribed ones. V: as if the joint were
   rigid. */
static void fbi_axes_out(fb_real V[6], fbi_link_work *L, const fb_joint *joint)
{
  fb_sym6_mul_vec6(L->G, L->S, V);
  for (int i = joint->n_axis - 1; i >= 0; i--) {
    if (L->mode[i] == FB_AXIS_FREE) {
      L->u[i] = L->r[i] - L->D[i] * fbi_vec6_dot(L->U + 6 * i, V);
      fbi_vec6_add(V, L->u[i], L->A + 6 * i);
    } else {
      L->u[i] = L->mode[i] == FB_AXIS_PRESCRIBED ? L->p[i] : FB_R(0.0);
    }
  }
  for (int i = 0; i < joint->n_axis; i++) {
    if (L->mode[i] == FB_AXIS_PRESCRIBED) {
      fbi_vec6_add(V, L->u[i], L->A + 6 * i);
    }
  }
}

/* q_dot of the modes at V of their body: L^T q_dot = e - X^T V with E = L L^T, e and X forward-substituted; where they
   carry nothing q_dot = e - M^-1 Lambda^T V. */
static void fbi_modes_out(fbi_link_work *L, const fb_body *body, const fb_real V[6])
{
  const int n = body->n;
  if (L->open) {
    for (int a = 0; a < n; a++) {
      L->q_dot[a] = L->e[a] - fbi_vec6_dot(L->X + 6 * a, V);
    }
    fbi_chol_back(L->q_dot, L->E, L->q_dot, n);
  } else if (n > 0 && L->has_speeds) {
    fb_real e[FB_MAX_MODES], unused[FB_MAX_MODES + 1] = {0};
    fbi_zero(e, n);
    fbi_lambda_gradients(e, unused, body, V, L->k.qx, L->e);
    fbi_mass_solve(L->q_dot, body, e);
    for (int a = 0; a < n; a++) {
      L->q_dot[a] += L->e[a];
    }
  }
}

/* Back-substitution in one body: V from the velocity of the node that carries it (NULL: the ground), the speeds of its
   joint and modes, and the momentum G = S V + b of the subtree. */
static fb_status fbi_link_out(fbi_link_work *L, const fb_joint *joint, const fb_body *body, const fb_real node[6])
{
  fb_real V[6] = {0};
  if (joint->kind == FB_JOINT_FREE) {
    const fb_status status = fbi_free_out(V, L, body->n);
    if (status != FB_OK) {
      return status;
    }
  } else {
    if (node) {
      fbi_from_node(V, L, node);
    }
    fbi_axes_out(V, L, joint);
  }
  fbi_vec6_copy(L->V, V);
  fbi_vec6_add(L->G, FB_R(1.0), L->b);
  fbi_modes_out(L, body, V);
  return FB_OK;
}

/* Transmits b of a body to its parent (NULL: none) and subtracts its projection on the parent's n modes from e. */
static void fbi_hand_in(fbi_link_work *parent, const fbi_link_work *L, const fb_joint *joint, int n)
{
  if (parent && joint->moves) {
    fb_real b[6] = {0};
    fbi_to_parent_add(b, L, L->b);
    for (int a = 0; a < n; a++) {
      parent->e[a] -= fb_vec3_dot(L->node.Ju + 3 * a, b) + fb_vec3_dot(L->node.Jphi + 3 * a, b + 3);
    }
    fbi_vec3_add_cross(b + 3, L->n, b);
    fbi_vec6_add(parent->b, FB_R(1.0), b);
  } else if (parent) {
    fbi_to_parent_add(parent->b, L, L->b);
  }
}

/* The same for body k, without the pointers that fbi_links_place sets. */
static void fbi_hand_in_at(fb_system_work *w, const fb_system *system, const fb_body *body, int k)
{
  const fb_joint *joint = fbi_link_joint(system, w, k);
  fbi_hand_in(fbi_parent(w, joint), &w->link[k], joint,
              joint->parent >= 0 ? fbi_model(system, body, joint->parent)->n : 0);
}

/* [E9.5] Solution of M u = p with the factors of E9.4: in from the tips, b = momentum of the subtree at V = 0, out
   from the ground. p of a prescribed axis is its speed; y is a momentum (or load) on the body itself, about O, that p
   and pi do not contain. b and G become the momentum of the subtree less y.
   Source: back-substitution.  Cost: 200 flops a body.  Test: the_three_methods_agree, momenta_give_back_the_speeds. */
static FBI_FLATTEN fb_status fbi_tree_solve(fb_system_work *w, const fb_system *system)
{
  /* right-hand side */
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *L = &w->link[k];
    fbi_vec6_zero(L->b);
    fbi_vec6_add(L->b, -FB_R(1.0), L->y);
    fbi_copy(L->e, L->pi, L->model->n);
  }

  /* in from the tips */
  for (int k = system->n_body - 1; k >= 0; k--) {
    fbi_link_work *L = &w->link[k], *parent = L->parent;
    fbi_link_in(L, L->joint, L->model);
    fbi_hand_in(parent, L, L->joint, parent ? parent->model->n : 0);
  }

  /* out from the ground */
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *L = &w->link[k];
    const fbi_link_work *parent = L->parent;
    fb_real node[6];
    fb_status status;
    if (parent) {
      fbi_node_velocity(node, L, L->joint, parent->model, parent->V, parent->q_dot);
    }
    status = fbi_link_out(L, L->joint, L->model, parent ? node : NULL);
    if (status != FB_OK) {
      w->joint = k;
      return status;
    }
  }
  return FB_OK;
}

/* ---- the same by one dense matrix */

/* Index of the first speed of body k; the speeds of its joint come first, then those of its modes. */
static int fbi_speed_offset(const fb_system *system, const fb_system_work *w, const fb_body *body, int k)
{
  int at = 0;
  for (int i = 0; i < k; i++) {
    at += fbi_link_joint(system, w, i)->n_axis + fbi_model(system, body, i)->n;
  }
  return at;
}

/* T of body k: row c is its velocity V per unit of speed c. */
static void fbi_velocity_map(fb_system_work *w, const fb_system *system, const fb_body *body, int k, int N)
{
  const fbi_link_work *L = &w->link[k];
  const fb_joint *joint = fbi_link_joint(system, w, k);
  const int at = fbi_speed_offset(system, w, body, k);
  fb_real *T = w->T + 6 * k * N;
  fbi_zero(T, 6 * N);

  /* speeds further in: by the parent and the node */
  if (joint->parent >= 0) {
    const fb_body *on = fbi_model(system, body, joint->parent);
    const fb_real *parent = w->T + 6 * joint->parent * N;
    const int first = fbi_speed_offset(system, w, body, joint->parent + 1) - on->n;
    for (int c = 0; c < at; c++) {
      fb_real q_dot[FB_MAX_MODES] = {0}, node[6];
      if (c >= first && c < first + on->n) {
        q_dot[c - first] = FB_R(1.0);
      }
      fbi_node_velocity(node, L, joint, on, parent + 6 * c, q_dot);
      fbi_from_node(T + 6 * c, L, node);
    }
  }

  /* speeds of its own joint */
  for (int i = 0; i < joint->n_axis; i++) {
    if (joint->kind == FB_JOINT_FREE) {
      T[6 * (at + i) + i] = FB_R(1.0);
    } else {
      fbi_vec6_copy(T + 6 * (at + i), L->A + 6 * i);
    }
  }
}

/* Adds body k to the lower triangle of M: T^T M_rr T and Lambda^T T by the speeds up to those of its joint, E of its
   modes, and g C + g^2 K of its joint. */
static void fbi_dense_add(fb_system_work *w, const fb_system *system, const fb_body *body, fb_real g, int k, int N)
{
  fbi_link_work *L = &w->link[k];
  const fb_body *model = fbi_model(system, body, k);
  const fb_joint *joint = fbi_link_joint(system, w, k);
  const int axes = fbi_speed_offset(system, w, body, k), modes = axes + joint->n_axis;
  const fb_real *T = w->T + 6 * k * N;

  /* own inertia and velocity map */
  fbi_S_eval(L->S, model, L->k.qx, model->n_run);
  fbi_link_open(L, model, g, w->heavy);
  fbi_velocity_map(w, system, body, k, N);

  /* T^T M_rr T and Lambda^T T */
  for (int c = 0; c < modes; c++) {
    fb_real momentum[6];
    fb_sym6_mul_vec6(momentum, L->S, T + 6 * c);
    for (int d = 0; d <= c; d++) {
      w->M[c * N + d] += fbi_vec6_dot(T + 6 * d, momentum);
    }
    for (int a = 0; a < model->n; a++) {
      w->M[(modes + a) * N + c] += fbi_vec6_dot(L->X + 6 * a, T + 6 * c);
    }
  }

  /* E of its modes; damping and stiffness of its joint */
  for (int a = 0; a < model->n; a++) {
    fbi_row_sub(w->M + (modes + a) * N + modes, -FB_R(1.0), L->E + a * model->n, a + 1);
  }
  for (int i = 0; i < joint->n_axis && joint->kind != FB_JOINT_FREE; i++) {
    w->M[(axes + i) * (N + 1)] += g * joint->damping[i] + g * g * joint->stiffness[i];
  }
}

/* Identity rows of M for the axes of body k's joint that are locked or prescribed. */
static void fbi_dense_hold(fb_system_work *w, const fb_system *system, const fb_body *body, int k, int N)
{
  const fb_joint *joint = fbi_link_joint(system, w, k);
  const int axes = fbi_speed_offset(system, w, body, k);
  for (int i = 0; i < joint->n_axis; i++) {
    if (fbi_axis_mode(&w->link[k], joint, i) != FB_AXIS_FREE) {
      fbi_zero(w->M + (axes + i) * N, N);
      w->M[(axes + i) * (N + 1)] = FB_R(1.0);
    }
  }
}

/* [E9.6] Mass matrix of a tree, M = sum of (T, 1)^T [M_rr Lambda; Lambda^T E] (T, 1) over the bodies, V = T u, with
   identity rows for axes that are locked or prescribed; LU factors.
   Source: THEORY.md 9.1; [H] 3.3.  Cost: bodies N^2 and 2/3 N^3 flops.  Fails: singular.
   Test: the_three_methods_agree. */
static FBI_NOINLINE fb_status fbi_dense_factor(fb_system_work *w, const fb_system *system, const fb_body *body,
                                               fb_real g)
{
  const int N = fbi_speed_offset(system, w, body, system->n_body);
  fb_status status;

  /* lower triangle, mirrored to the upper one */
  fbi_zero(w->M, N * N);
  for (int k = 0; k < system->n_body; k++) {
    fbi_dense_add(w, system, body, g, k, N);
  }
  for (int c = 0; c < N; c++) {
    for (int d = 0; d < c; d++) {
      w->M[d * N + c] = w->M[c * N + d];
    }
  }

  /* identity rows, factors */
  for (int k = 0; k < system->n_body; k++) {
    fbi_dense_hold(w, system, body, k, N);
  }
  status = fb_lu_factor(w->M, w->perm, w->z, N);
  return status == FB_ERR_SINGULAR ? FB_ERR_UNDETERMINED : status;
}

/* E9.5 with the factors of E9.6. */
static FBI_NOINLINE void fbi_dense_solve(fb_system_work *w, const fb_system *system, const fb_body *body)
{
  const int N = fbi_speed_offset(system, w, body, system->n_body);

  /* loads on the bodies */
  for (int k = 0; k < system->n_body; k++) {
    for (int i = 0; i < 6; i++) {
      w->link[k].b[i] = -w->link[k].y[i];
    }
    fbi_copy(w->link[k].e, w->link[k].pi, fbi_model(system, body, k)->n);
  }

  /* right-hand side, summed from the tips */
  for (int k = system->n_body - 1; k >= 0; k--) {
    fbi_link_work *L = &w->link[k];
    const fb_joint *joint = fbi_link_joint(system, w, k);
    const int at = fbi_speed_offset(system, w, body, k);
    for (int i = 0; i < joint->n_axis; i++) {
      const fb_real along = joint->kind == FB_JOINT_FREE ? L->b[i] : fbi_vec6_dot(L->A + 6 * i, L->b);
      const fb_real given = fbi_axis_mode(L, joint, i) == FB_AXIS_PRESCRIBED ? L->p[i] : FB_R(0.0);
      w->z[at + i] = fbi_axis_mode(L, joint, i) != FB_AXIS_FREE ? given : L->p[i] - along;
    }
    fbi_copy(w->z + at + joint->n_axis, L->e, fbi_model(system, body, k)->n);
    fbi_hand_in_at(w, system, body, k);
  }

  /* speeds, velocities and momenta of the bodies */
  fb_lu_solve(w->speed, w->M, w->perm, w->z, N);
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *L = &w->link[k];
    const fb_body *model = fbi_model(system, body, k);
    const fb_joint *joint = fbi_link_joint(system, w, k);
    const int at = fbi_speed_offset(system, w, body, k);
    fbi_copy(L->u, w->speed + at, joint->n_axis);
    fbi_copy(L->q_dot, w->speed + at + joint->n_axis, model->n);
    fbi_vec6_zero(L->V);
    for (int c = 0; c < N; c++) {
      fbi_row_sub(L->V, -w->speed[c], w->T + 6 * (k * N + c), 6);
    }
    fb_sym6_mul_vec6(L->b, L->S, L->V);
    for (int a = 0; a < model->n; a++) {
      fbi_vec6_add(L->b, L->q_dot[a], L->X + 6 * a);
    }
    fbi_vec6_add(L->b, -FB_R(1.0), L->y);
  }

  /* momenta G of the subtrees */
  for (int k = system->n_body - 1; k >= 0; k--) {
    fbi_vec6_copy(w->link[k].G, w->link[k].b);
    fbi_hand_in_at(w, system, body, k);
  }
}

static fb_status fbi_mass_factor(fb_system_work *w, const fb_system *system, const fb_body *body, fb_real g)
{
  w->joint = -1;
  if (system->method == FB_METHOD_DENSE) {
    const fb_status status = fbi_dense_factor(w, system, body, g);
    if (status == FB_ERR_UNDETERMINED) {
      (void)fbi_tree_factor(w, system, g); /* finds the joint at fault */
    }
    return status;
  }
  return fbi_tree_factor(w, system, g);
}

static fb_status fbi_speeds_solve(fb_system_work *w, const fb_system *system, const fb_body *body)
{
  if (system->method == FB_METHOD_DENSE) {
    fbi_dense_solve(w, system, body);
    return FB_OK;
  }
  return fbi_tree_solve(w, system);
}

/* ---- constraints */

/* End of a constraint, a node of a body or the ground: its index among the ends found so far, or a new one. */
static fb_status fbi_end_find(int *at, fb_system_work *w, const fb_system *system, const fb_body *body, int link,
                              int node)
{
  fbi_end *end = w->end;
  FBI_REQUIRE(link >= FB_GROUND && link < system->n_body, FB_ERR_CAPACITY);
  FBI_REQUIRE(node >= 0 && node < (link < 0 ? 1 : fbi_model(system, body, link)->n_node), FB_ERR_CAPACITY);

  /* known already? */
  for (*at = 0; *at < w->n_end; ++*at, end++) {
    if (end->link == link && end->node == node) {
      return FB_OK;
    }
  }

  /* new, on the ground */
  FBI_REQUIRE(w->n_end < FBI_MAX_ENDS, FB_ERR_CAPACITY);
  w->n_end++;
  memset(end, 0, sizeof *end);
  end->link = link;
  end->node = node;
  end->R[0] = end->R[4] = end->R[8] = FB_R(1.0);

  /* on a body: position and section axes of the node */
  if (link >= 0) {
    const fb_body *model = fbi_model(system, body, link);
    const fbi_link_work *L = &w->link[link];
    fb_real quat[4], turn[9];
    end->moves = fbi_node_moves(model, node);
    fbi_node_eval(&end->f, model, &model->node[node], L->k.qx + 1);
    fbi_vec3_copy(end->n, model->node[node].r);
    fbi_vec3_add(end->n, FB_R(1.0), end->f.u);
    fbi_node_quat(quat, &end->f);
    fb_quat_to_mat33(turn, quat);
    fb_mat33_mul(end->R, L->k.R, turn);
    fb_mat33_mul_vec3(end->x, L->k.R, end->n);
    fbi_vec3_add(end->x, FB_R(1.0), L->rho);
  }
  return FB_OK;
}

/* Velocity v and angular velocity w of an end, inertial axes, from the solution V, q_dot. */
static void fbi_end_velocity(fb_real v[3], fb_real w_I[3], const fb_system_work *w, const fb_system *system,
                             const fb_body *body, const fbi_end *end)
{
  fbi_vec3_zero(v);
  fbi_vec3_zero(w_I);
  if (end->link >= 0) {
    const fbi_link_work *L = &w->link[end->link];
    fb_real velocity[3], rate[3];
    fbi_vec3_copy(velocity, L->V);
    fbi_vec3_copy(rate, L->V + 3);
    fbi_vec3_add_cross(velocity, L->V + 3, end->n);
    for (int a = 0; a < fbi_model(system, body, end->link)->n && end->moves; a++) {
      fbi_vec3_add(velocity, L->q_dot[a], end->f.Ju + 3 * a);
      fbi_vec3_add(rate, L->q_dot[a], end->f.Jphi + 3 * a);
    }
    fb_mat33_mul_vec3(v, L->k.R, velocity);
    fb_mat33_mul_vec3(w_I, L->k.R, rate);
  }
}

/* Adds s times a force and torque (inertial axes) on the node of an end, to y about its body's origin and to e of the
   modes. */
static void fbi_end_push(fb_real y[6], fb_real *e, const fbi_link_work *L, const fbi_end *end, int n, fb_real s,
                         const fb_real force[3], const fb_real torque[3])
{
  fb_real f[3], t[3];
  fb_mat33_mulT_vec3(f, L->k.R, force);
  fb_mat33_mulT_vec3(t, L->k.R, torque);
  for (int a = 0; a < n && end->moves; a++) {
    e[a] += s * (fb_vec3_dot(end->f.Ju + 3 * a, f) + fb_vec3_dot(end->f.Jphi + 3 * a, t));
  }
  fbi_vec3_add_cross(t, end->n, f);
  fbi_vec3_add(y, s, f);
  fbi_vec3_add(y + 3, s, t);
}

typedef struct fbi_frames { /* joint frames, inertial axes: sketch at fbi_frames_eval */
  fbi_end *end[2];
  int at[2];                /* indices of the ends */
  fb_real a[3][3], b[3][3]; /* axes x, y, z on the parent, on the child */
  fb_real x[2][3];          /* origins on the parent, on the child */
  fb_real arm[2][3];        /* from each end to x[1] */
  fb_real step[3];          /* from x[0] to x[1] */
} fbi_frames;

/* Joint frames of joint j on its parent (origin x[0], axes a[i]) and child (origin x[1], axes b[i]), of a joint that is
   enforced by multipliers. Ends are the nodes that carry them; rows exert their forces at x[1].

                       step
          x[0] o----------------> o x[1]
               ^               .^ ^
      position |        arm[0]    | arm[1] = child_position
               |       .          |
        end[0] o . '              o end[1]
        parent's node             child's node */
static fb_status fbi_frames_eval(fbi_frames *f, fb_system_work *w, const fb_system *system, const fb_body *body, int j)
{
  const fb_joint *joint = &system->joint[j];
  const fb_real *local[2], *axes[2];
  int parent_node = joint->parent_node;
  fb_status status;
  local[0] = joint->position;
  local[1] = joint->child_position;
  axes[0] = joint->axes;
  axes[1] = joint->child_axes;
  if (!joint->moves) {
    parent_node = 0; /* the position is from O, node 0 */
  }

  /* ends */
  status = fbi_end_find(&f->at[0], w, system, body, joint->parent, parent_node);
  status = status == FB_OK ? fbi_end_find(&f->at[1], w, system, body, joint->child, joint->child_node) : status;
  if (status != FB_OK) {
    return status;
  }

  /* origins and axes */
  for (int s = 0; s < 2; s++) {
    f->end[s] = &w->end[f->at[s]];
    fb_mat33_mul_vec3(f->x[s], f->end[s]->R, local[s]);
    fbi_vec3_add(f->x[s], FB_R(1.0), f->end[s]->x);
    for (int i = 0; i < 3; i++) {
      const fb_real column[3] = {axes[s][i], axes[s][3 + i], axes[s][6 + i]};
      fb_mat33_mul_vec3(s == 0 ? f->a[i] : f->b[i], f->end[s]->R, column);
    }
  }

  /* vectors to the child's origin, which may be in the frame of another tree */
  for (int i = 0; i < 3; i++) {
    f->step[i] = f->x[1][i] - f->x[0][i];
    f->arm[0][i] = f->x[1][i] - f->end[0]->x[i];
    f->arm[1][i] = f->x[1][i] - f->end[1]->x[i];
  }
  fbi_frames_apart_add(f->step, FB_R(1.0), w, joint->parent, joint->child, 0);
  fbi_frames_apart_add(f->arm[0], FB_R(1.0), w, joint->parent, joint->child, 0);
  return FB_OK;
}

/* [E9.7] Coordinates of a joint from its frames; angles within half a revolution. Spherical: the rotation vector.
   Source: [H] 3.1.  Test: the_three_methods_agree. */
static void fbi_frames_value(fb_real value[3], const fbi_frames *f, const fb_joint *joint)
{
  const fbi_joint_traits *is = fbi_traits(joint);
  fbi_vec3_zero(value);
  if (fbi_is_ball(joint->kind)) {
    fb_real R[9], quat[4];
    for (int i = 0; i < 9; i++) {
      R[i] = fb_vec3_dot(f->a[i / 3], f->b[i % 3]);
    }
    fbi_quat_from_mat33(quat, R);
    fb_quat_to_rotvec(value, quat);
  }
  if (is->angle >= 0) {
    value[is->angle] = FB_ATAN2(fb_vec3_dot(f->a[1], f->b[0]), fb_vec3_dot(f->a[0], f->b[0]));
  }
  if (is->slide >= 0) {
    value[is->slide] = fb_vec3_dot(f->step, f->a[2]);
  }
  if (is->tilt >= 0) {
    value[is->tilt] = FB_ATAN2(fb_vec3_dot(f->a[2], f->b[1]), fb_vec3_dot(f->a[2], f->b[2]));
  }
}

/* Direction (force, torque) in which an effort on axis i of a joint acts on the child, at the child's joint frame. */
static void fbi_frames_axis(fb_real force[3], fb_real torque[3], const fbi_frames *f, const fb_joint *joint, int i)
{
  const fbi_joint_traits *is = fbi_traits(joint);
  fbi_vec3_zero(force);
  fbi_vec3_zero(torque);
  if (i == is->slide) {
    fbi_vec3_copy(force, f->a[2]);
  } else {
    fbi_vec3_copy(torque, fbi_is_ball(joint->kind) ? f->b[i] : i == is->tilt ? f->b[0] : f->a[2]);
  }
}

/* New row of joint j: (force, torque) on the child at its joint frame, the reaction on the parent. NULL: no room. */
static fbi_row *fbi_row_new(fb_system_work *w, const fbi_frames *f, int j, const fb_real force[3],
                            const fb_real torque[3], fb_real value)
{
  fbi_row *row;
  if (w->n_row >= FB_MAX_ROWS) {
    return NULL;
  }

  /* a holonomic row with this value */
  row = &w->row[w->n_row++];
  memset(row, 0, sizeof *row);
  row->joint = j;
  row->r.holonomic = 1;
  row->r.value = value;

  /* force and torque at both ends */
  for (int s = 0; s < 2; s++) {
    const fb_real sign = s == 0 ? -FB_R(1.0) : FB_R(1.0);
    fb_real moment[3];
    row->end[s] = f->at[s];
    fbi_vec3_add(row->r.force[s], sign, force);
    fbi_vec3_add(row->r.torque[s], sign, torque);
    fb_vec3_cross(moment, f->arm[s], force);
    fbi_vec3_add(row->r.torque[s], sign, moment);
  }
  return row;
}

static fb_real fbi_angle_wrap(fb_real angle)
{
  return FB_ATAN2(FB_SIN(angle), FB_COS(angle));
}

/* Is axis i of the joint a translation? */
static int fbi_axis_slides(const fb_joint *joint, int i)
{
  return i == fbi_traits(joint)->slide;
}

/* Rows of the axes that are locked or prescribed; 0: no room. */
static int fbi_given_rows(fb_system_work *w, const fb_system *system, const fbi_frames *f, int j,
                          const fb_system_state *modes, const fb_system_input *input)
{
  const fb_joint *joint = &system->joint[j];
  fb_real value[3], force[3], torque[3];
  fbi_frames_value(value, f, joint);
  for (int i = 0; i < joint->n_axis; i++) {
    const int prescribed = modes->mode[j][i] == FB_AXIS_PRESCRIBED;
    const fb_real target = !prescribed ? modes->hold[j][i] : input ? input->drive[j].value[i] : FB_R(0.0);
    fb_real miss = value[i] - target;
    fbi_row *row;
    if (modes->mode[j][i] == FB_AXIS_FREE) {
      continue;
    }

    /* direction of the axis; miss: the constraint violation */
    fbi_frames_axis(force, torque, f, joint, i);
    if (joint->kind == FB_JOINT_SPHERICAL && !prescribed) { /* relative to the axes when it was locked */
      fb_real hold[9], b[3] = {0};
      const int next = (i + 1) % 3;
      fb_quat_to_mat33(hold, modes->hold_quat[j]);
      for (int k = 0; k < 3; k++) {
        fbi_vec3_add(b, hold[3 * next + k], f->b[k]);
      }
      fb_vec3_cross(torque, b, f->a[i]);
      miss = fb_vec3_dot(f->a[i], b);
    } else if (!fbi_axis_slides(joint, i)) {
      miss = fbi_angle_wrap(miss);
    }

    /* row; a prescribed axis moves at the rate of its drive */
    row = fbi_row_new(w, f, j, force, torque, miss);
    if (!row) {
      return 0;
    }
    row->axis = i;
    if (prescribed) {
      row->r.b = input ? -input->drive[j].rate[i] : FB_R(0.0);
      row->b_dot = input ? -input->drive[j].acceleration[i] : FB_R(0.0);
      row->r.holonomic = joint->kind != FB_JOINT_SPHERICAL;
    }
  }
  return 1;
}

/* [E9.8] Constraint rows of a joint: force and torque on the child at its joint frame, the reaction on the parent.
   Translation along a_i: force a_i, value a_i.(x_b - x_a). Right angle of a_i and b_j: torque b_j x a_i, value
   a_i.b_j. Screw: force a_z, torque -pitch a_z, value slide - pitch angle. Each is the exact gradient of its value.
   Source: [H] 3.4; direction cosines.  Fails: more than FB_MAX_ROWS.  Test: the_three_methods_agree. */
static fb_status fbi_joint_rows(fb_system_work *w, const fb_system *system, const fb_body *body, int j,
                                const fb_system_state *modes, const fb_system_input *input)
{
  const fb_joint *joint = &system->joint[j];
  static const fb_real none[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)};
  fbi_frames f;
  const fb_status status = fbi_frames_eval(&f, w, system, body, j);
  int room = 1;
  if (status != FB_OK) {
    return status;
  }

  /* translations and right angles */
  for (const int *hold = fbi_traits(joint)->holds; *hold >= 0 && room; hold++) {
    const fb_real *a = f.a[*hold < 3 ? *hold : (*hold - 3) / 3];
    fbi_row *row;
    if (*hold < 3) {
      row = fbi_row_new(w, &f, j, a, none, fb_vec3_dot(a, f.step));
    } else {
      const fb_real *b = f.b[(*hold - 3) % 3];
      fb_real torque[3];
      fb_vec3_cross(torque, b, a);
      row = fbi_row_new(w, &f, j, none, torque, fb_vec3_dot(a, b));
    }
    room = row != NULL;
    if (row) {
      row->axis = -1 - *hold;
    }
  }

  /* screw: slide - pitch angle, modulo whole revolutions */
  if (fbi_traits(joint)->pitched && room) {
    const int angle = fbi_traits(joint)->angle;
    const fb_real slide = fb_vec3_dot(f.a[2], f.step);
    fb_real value[3], torque[3] = {0}, miss;
    fbi_row *row;
    fbi_frames_value(value, &f, joint);
    fbi_vec3_add(torque, -joint->pitch, f.a[2]);
    miss = joint->pitch == FB_R(0.0) ? slide : joint->pitch * fbi_angle_wrap(slide / joint->pitch - value[angle]);
    row = fbi_row_new(w, &f, j, f.a[2], torque, miss);
    room = row != NULL;
    if (row) {
      row->axis = angle;
    }
  }

  /* locked and prescribed axes */
  return room && fbi_given_rows(w, system, &f, j, modes, input) ? FB_OK : FB_ERR_CAPACITY;
}

/* Time derivatives of a joint's row along the motion of its ends: axes of the parent rotate with the parent, those of
   the child with the child. Rows of locked and prescribed axes rotate with the parent; with the child would do as
   well, as the difference is a torque perpendicular to the motion, which the joint bears. Positions are those of the
   rows, so that fbi_frames_eval finds its ends and cannot fail. */
static void fbi_joint_row_rates(fbi_row *row, fb_system_work *w, const fb_system *system, const fb_body *body)
{
  const int hold = -1 - row->axis;
  fbi_frames f;
  fb_real force[3] = {0}, force_dot[3] = {0}, torque_dot[3] = {0}, at_child[3];
  (void)fbi_frames_eval(&f, w, system, body, row->joint);
  fbi_vec3_copy(force, row->r.force[1]);

  /* force_dot, torque_dot at the child's joint frame */
  if (row->axis >= 0) {
    fb_real torque[3], moment[3];
    fb_vec3_cross(moment, f.arm[1], force);
    for (int i = 0; i < 3; i++) {
      torque[i] = row->r.torque[1][i] - moment[i];
    }
    fb_vec3_cross(force_dot, f.end[0]->w, force);
    fb_vec3_cross(torque_dot, f.end[0]->w, torque);
  } else if (hold < 3) {
    fb_vec3_cross(force_dot, f.end[0]->w, force);
  } else {
    const fb_real *a = f.a[(hold - 3) / 3], *b = f.b[(hold - 3) % 3];
    fb_real a_dot[3], b_dot[3];
    fb_vec3_cross(a_dot, f.end[0]->w, a);
    fb_vec3_cross(b_dot, f.end[1]->w, b);
    fb_vec3_cross(torque_dot, b_dot, a);
    fbi_vec3_add_cross(torque_dot, b, a_dot);
  }

  /* velocity of the child's joint origin */
  fbi_vec3_copy(at_child, f.end[1]->v);
  fbi_vec3_add_cross(at_child, f.end[1]->w, f.arm[1]);

  /* both ends: the moment of the force changes by arm_dot x force + arm x force_dot */
  for (int s = 0; s < 2; s++) {
    const fb_real sign = s == 0 ? -FB_R(1.0) : FB_R(1.0);
    fb_real arm_dot[3], moment[3];
    for (int i = 0; i < 3; i++) {
      arm_dot[i] = at_child[i] - f.end[s]->v[i];
    }
    fbi_frames_apart_add(arm_dot, FB_R(1.0), w, f.end[s]->link, f.end[1]->link, 1);
    fb_vec3_cross(moment, arm_dot, force);
    fbi_vec3_add_cross(moment, f.arm[s], force_dot);
    for (int i = 0; i < 3; i++) {
      row->force_dot[s][i] = sign * force_dot[i];
      row->torque_dot[s][i] = sign * (torque_dot[i] + moment[i]);
    }
  }
}

/* The caller's rows at time t + h [s], with the poses of the bodies moved on at their velocities; written to `row`.
   Returns their number or a negative status. */
static int fbi_user_rows(fb_row *row, fb_system_work *w, const fb_system *system, const fb_system_input *input,
                         fb_real h)
{
  memset(row, 0, FB_MAX_ROWS * sizeof *row);
  for (int k = 0; k < system->n_body; k++) {
    const fbi_link_work *L = &w->link[k];
    fb_real v[3], turn[4], phi[3], R[9];
    fb_mat33_mul_vec3(v, L->k.R, L->V);
    fbi_vec3_add(v, FB_R(1.0), w->link[L->root].frame);
    for (int i = 0; i < 3; i++) {
      w->pose[k].position[i] = fbi_true_position(w, k, L->rho, i) + (h == FB_R(0.0) ? h : h * v[i]);
      phi[i] = h == FB_R(0.0) ? h : h * L->V[3 + i];
    }
    fb_quat_from_rotvec(turn, phi);
    fb_quat_to_mat33(R, turn);
    fb_mat33_mul(w->pose[k].R, L->k.R, R);
  }
  return input->rows(row, FB_MAX_ROWS - w->n_joint_row, w->pose, input->t + h, input->user);
}

/* All constraint rows at the present positions: those of joints, then those of the caller. */
static FBI_NOINLINE fb_status fbi_rows_fill(fb_system_work *w, const fb_system *system, const fb_body *body,
                                            const fb_system_state *modes, const fb_system_input *input)
{
  fb_status status = FB_OK;
  w->n_row = w->n_end = 0;

  /* joints that are enforced by multipliers */
  for (int j = 0; j < system->n_body + system->n_loop && status == FB_OK; j++) {
    if (fbi_is_kept(system, w, j)) {
      status = fbi_joint_rows(w, system, body, j, modes, input);
      w->joint = status == FB_OK ? w->joint : j;
    }
  }
  w->n_joint_row = w->n_row;

  /* rows of the caller */
  if (status == FB_OK && input && input->rows) {
    const int count = fbi_user_rows(w->ahead, w, system, input, FB_R(0.0));
    if (count < 0 || count > FB_MAX_ROWS - w->n_row) {
      return count < 0 ? (fb_status)count : FB_ERR_CAPACITY;
    }

    /* ends and finite values of each */
    for (int k = 0; k < count && status == FB_OK; k++) {
      const fb_real rest[2] = {w->ahead[k].b, w->ahead[k].value};
      fbi_row *row = &w->row[w->n_row++];
      memset(row, 0, sizeof *row);
      row->r = w->ahead[k];
      row->joint = -2 - k;
      for (int s = 0; s < 2 && status == FB_OK; s++) {
        status = fbi_end_find(&row->end[s], w, system, body, row->r.body[s], row->r.node[s]);
      }
      if (status == FB_OK &&
          (!fbi_is_finite(row->r.force[0], 3) || !fbi_is_finite(row->r.force[1], 3) ||
           !fbi_is_finite(row->r.torque[0], 3) || !fbi_is_finite(row->r.torque[1], 3) || !fbi_is_finite(rest, 2))) {
        status = FB_ERR_NOT_FINITE;
      }
      w->joint = status == FB_OK ? w->joint : row->joint;
    }
  }
  return status;
}

/* Velocities of the ends from the solution, then the time derivatives of the rows; those of the caller's by central
   differences over a small angle. */
static FBI_NOINLINE fb_status fbi_rows_rate(fb_system_work *w, const fb_system *system, const fb_body *body,
                                            const fb_system_input *input)
{
  const int count = w->n_row - w->n_joint_row;

  /* ends and rows of joints */
  for (int e = 0; e < w->n_end; e++) {
    fbi_end_velocity(w->end[e].v, w->end[e].w, w, system, body, &w->end[e]);
  }
  for (int r = 0; r < w->n_joint_row; r++) {
    fbi_joint_row_rates(&w->row[r], w, system, body);
  }

  /* rows of the caller; in h the fastest body rotates by at most 1e-5 rad (single: 5e-3) */
  if (count > 0 && input) {
    fb_real spin = FB_R(1.0), h;
    for (int k = 0; k < system->n_body; k++) {
      spin = fbi_larger(spin, fbi_vec3_norm(w->link[k].V + 3));
    }
    h = (FB_SINGLE ? FB_R(5e-3) : FB_R(1e-5)) / spin;
    for (int side = 0; side < 2; side++) {
      const int found = fbi_user_rows(side ? w->behind : w->ahead, w, system, input, side ? -h : h);
      if (found != count) {
        return found < 0 ? (fb_status)found : FB_ERR_VALUE;
      }
    }
    for (int r = 0; r < count; r++) {
      fbi_row *row = &w->row[w->n_joint_row + r];
      const fb_row *a = &w->ahead[r], *b = &w->behind[r];
      const fb_real scale = FB_R(0.5) / h;
      row->b_dot = scale * (a->b - b->b);
      for (int i = 0; i < 6; i++) {
        row->force_dot[i / 3][i % 3] = scale * (a->force[i / 3][i % 3] - b->force[i / 3][i % 3]);
        row->torque_dot[i / 3][i % 3] = scale * (a->torque[i / 3][i % 3] - b->torque[i / 3][i % 3]);
      }
    }
  }
  return FB_OK;
}

/* Velocities of all ends by the solution, for fbi_row_eval. */
static void fbi_ends_move(fb_system_work *w, const fb_system *system, const fb_body *body)
{
  for (int e = 0; e < w->n_end; e++) {
    fbi_end_velocity(w->end[e].move, w->end[e].move + 3, w, system, body, &w->end[e]);
  }
}

/* Row times velocities, A u: force.v + torque.w over both ends. */
static fb_real fbi_row_eval(const fbi_row *row, const fb_system_work *w)
{
  const fb_real *a = w->end[row->end[0]].move, *b = w->end[row->end[1]].move;
  return fb_vec3_dot(row->r.force[0], a) + fb_vec3_dot(row->r.torque[0], a + 3) + fb_vec3_dot(row->r.force[1], b) +
         fb_vec3_dot(row->r.torque[1], b + 3);
}

/* Upper bound of fbi_row_eval: its value if all vectors were parallel. */
static fb_real fbi_row_size(const fbi_row *row, const fb_system_work *w)
{
  fb_real size = FB_R(0.0);
  for (int s = 0; s < 2; s++) {
    const fb_real *move = w->end[row->end[s]].move;
    size += fbi_vec3_norm(row->r.force[s]) * fbi_vec3_norm(move);
    size += fbi_vec3_norm(row->r.torque[s]) * fbi_vec3_norm(move + 3);
  }
  return size;
}

/* Contribution of the velocities u of the tree frames to a row: the sum of force.u; opposite forces within a tree
   contribute nothing. size: its upper bound as above. */
static fb_real fbi_row_drift(fb_real *size, const fb_system_work *w, const fbi_row *row, const fb_real force[2][3])
{
  fb_real sum = FB_R(0.0);
  int link[2];
  for (int s = 0; s < 2; s++) {
    link[s] = w->end[row->end[s]].link;
  }
  *size = FB_R(0.0);

  /* both ends in one tree: the resultant alone */
  if (link[0] >= 0 && link[1] >= 0 && w->link[link[0]].root == w->link[link[1]].root) {
    const fb_real *u = w->link[w->link[link[0]].root].frame;
    for (int i = 0; i < 3; i++) {
      sum += (force[0][i] + force[1][i]) * u[i];
    }
    *size = FB_FABS(sum);
    return sum;
  }

  /* different trees, or the ground */
  for (int s = 0; s < 2; s++) {
    const fb_real *u = link[s] >= 0 ? w->link[w->link[link[s]].root].frame : NULL;
    sum += u ? fb_vec3_dot(force[s], u) : FB_R(0.0);
    *size += u ? fbi_vec3_norm(force[s]) * fbi_vec3_norm(u) : FB_R(0.0);
  }
  return sum;
}

/* Clears the right-hand side: no momenta, prescribed speeds zero. */
static void fbi_rhs_clear(fb_system_work *w, const fb_system *system, const fb_body *body)
{
  for (int k = 0; k < system->n_body; k++) {
    fbi_vec6_zero(w->link[k].y);
    fbi_vec6_zero(w->link[k].p);
    fbi_zero(w->link[k].pi, fbi_model(system, body, k)->n);
  }
}

/* Adds s times row r, as an impulse on its ends, to the right-hand side. */
static void fbi_row_impulse(fb_system_work *w, const fb_system *system, const fb_body *body, int r, fb_real s)
{
  const fbi_row *row = &w->row[r];
  for (int side = 0; side < 2; side++) {
    const fbi_end *end = &w->end[row->end[side]];
    if (end->link >= 0) {
      fbi_link_work *L = &w->link[end->link];
      fbi_end_push(L->y, L->pi, L, end, fbi_model(system, body, end->link)->n, s, row->r.force[side],
                   row->r.torque[side]);
    }
  }
}

/* Are two rows of the same joint (or both the caller's), and both with a force or both without? */
static int fbi_rows_alike(const fbi_row *a, const fbi_row *b)
{
  const int force_a = fbi_vec3_norm(a->r.force[0]) + fbi_vec3_norm(a->r.force[1]) > FB_R(0.0);
  const int force_b = fbi_vec3_norm(b->r.force[0]) + fbi_vec3_norm(b->r.force[1]) > FB_R(0.0);
  return force_a == force_b && (a->joint == b->joint || (a->joint < -1 && b->joint < -1));
}

/* Q = A M^-1 A^T by columns, one solution for a unit impulse on each row; w->column: upper bounds of its diagonal. */
static fb_status fbi_rows_matrix(fb_system_work *w, const fb_system *system, const fb_body *body)
{
  const int m = w->n_row;
  for (int r = 0; r < m; r++) {
    fb_status status;
    fbi_rhs_clear(w, system, body);
    fbi_row_impulse(w, system, body, r, FB_R(1.0));
    status = fbi_speeds_solve(w, system, body);
    if (status != FB_OK) {
      return status;
    }
    fbi_ends_move(w, system, body);
    for (int i = r; i < m; i++) {
      w->Q[i * m + r] = w->Q[r * m + i] = fbi_row_eval(&w->row[i], w);
    }
    w->column[r] = fbi_row_size(&w->row[r], w);
  }
  return FB_OK;
}

/* Scales of the pivots, from the upper bounds of the diagonal in their place: the largest diagonal of rows of the same
   kind at the same joint; infinite, so that the row is left out, where its impulse moves its own ends across the row's
   direction or not at all. */
static void fbi_rows_scale(fb_real *scale, const fb_system_work *w)
{
  const int m = w->n_row;
  const fb_real across = FB_SINGLE ? FB_R(1e-5) : FB_R(1e-10);
  for (int i = 0; i < m; i++) {
    fb_real largest = FB_R(0.0);
    for (int r = 0; r < m; r++) {
      largest = fbi_rows_alike(&w->row[i], &w->row[r]) ? fbi_larger(largest, w->Q[r * (m + 1)]) : largest;
    }
    scale[i] = w->Q[i * (m + 1)] > across * scale[i] ? largest : FB_HUGE;
  }
}

/* Pivot k: where in w->order, from k on, the row is whose remaining diagonal is the largest relative to its scale. */
static int fbi_rows_pivot(const fb_system_work *w, const fb_real *scale, int k)
{
  int best = k;
  for (int i = k + 1; i < w->n_row; i++) {
    const int a = w->order[i], b = w->order[best];
    const int larger = w->diagonal[a] * scale[b] > w->diagonal[b] * scale[a];
    best += larger * (i - best); /* no branch: the work of a step depends on no value */
  }
  return best;
}

/* Column k of L, with row p = w->order[k] as pivot: L_pk^2 = d_p, L_rk = (Q_rp - sum of L_rj L_pj) / L_pk, and the
   diagonals d_r -= L_rk^2 that remain. w->diagonal of p becomes 1 / L_pk. */
static void fbi_rows_eliminate(fb_system_work *w, int k)
{
  const int m = w->n_row, p = w->order[k];
  const fb_real reciprocal = FB_R(1.0) / FB_SQRT(w->diagonal[p]);
  w->diagonal[p] = reciprocal;
  for (int i = k + 1; i < m; i++) {
    const int r = w->order[i];
    fb_real sum = w->Q[r * m + p];
    for (int j = 0; j < k; j++) {
      sum -= w->L[r * m + j] * w->L[p * m + j];
    }
    w->L[r * m + k] = sum * reciprocal;
    w->diagonal[r] -= w->L[r * m + k] * w->L[r * m + k];
  }
}

/* [E9.9] Q = A M^-1 A^T of the constraint rows and its pivoted Cholesky factors; rows that depend on others are left
   out, w->rank of them remain. w->order[k] is the row of pivot k, w->L[r m + k] the factor of row r. A pivot is the
   square of a row's distance from the span of the others: below 1e-8 of its scale, 1e-4 rad before a singular position
   (single precision: 0.01 rad), the impulses would be dominated by the position errors of a stage.
   Source: [GV] 4.2.8.  Shapes: Q n_row x n_row.  Cost: n_row solutions E9.5, n_row^3/3 flops.
   Fails: never.  Test: redundant_loops_are_accepted. */
static fb_status fbi_rows_factor(fb_system_work *w, const fb_system *system, const fb_body *body)
{
  const fb_real tol = FB_SINGLE ? FB_R(1e-4) : FB_R(1e-8);
  fb_real *scale = w->column;
  const fb_status status = fbi_rows_matrix(w, system, body);
  if (status != FB_OK) {
    return status;
  }
  fbi_rows_scale(scale, w);
  for (int r = 0; r < w->n_row; r++) {
    w->order[r] = r;
    w->diagonal[r] = w->Q[r * (w->n_row + 1)];
  }
  for (w->rank = 0; w->rank < w->n_row; w->rank++) {
    const int k = w->rank, best = fbi_rows_pivot(w, scale, k), p = w->order[best];
    if (!(w->diagonal[p] > tol * scale[p])) {
      break;
    }
    w->order[best] = w->order[k];
    w->order[k] = p;
    fbi_rows_eliminate(w, k);
  }
  return FB_OK;
}

/* Multipliers mu: Q mu = -c on the independent rows, zero on the others. */
static void fbi_rows_multipliers(fb_system_work *w)
{
  const int m = w->n_row, n = w->rank;
  fb_real *y = w->column;
  fbi_zero(w->mu, m);
  for (int k = 0; k < n; k++) {
    const int r = w->order[k];
    y[k] = (-w->c[r] - fbi_dot(w->L + r * m, y, k)) * w->diagonal[r];
  }
  for (int k = n - 1; k >= 0; k--) {
    const int r = w->order[k];
    fb_real sum = y[k];
    for (int i = k + 1; i < n; i++) {
      sum -= w->L[w->order[i] * m + k] * w->mu[w->order[i]];
    }
    w->mu[r] = sum * w->diagonal[r];
  }
}

/* Saves the right-hand side of all bodies; are there prescribed speeds in it? */
static int fbi_rhs_save(fb_system_work *w, const fb_system *system, const fb_body *body)
{
  int given = 0;
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *L = &w->link[k];
    fbi_vec6_copy(L->y0, L->y);
    fbi_vec6_copy(L->p0, L->p);
    fbi_copy(L->pi0, L->pi, fbi_model(system, body, k)->n);
    for (int i = 0; i < fbi_link_joint(system, w, k)->n_axis; i++) {
      const int drives = fbi_axis_mode(L, fbi_link_joint(system, w, k), i) == FB_AXIS_PRESCRIBED;
      given |= drives && FB_FABS(L->p[i]) > FB_R(0.0);
    }
  }
  return given;
}

/* Right-hand side with the impulses mu of the rows: the saved one and A^T mu. */
static void fbi_rhs_push(fb_system_work *w, const fb_system *system, const fb_body *body)
{
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *L = &w->link[k];
    fbi_vec6_copy(L->y, L->y0);
    fbi_vec6_copy(L->p, L->p0);
    fbi_copy(L->pi, L->pi0, fbi_model(system, body, k)->n);
  }
  for (int r = 0; r < w->n_row; r++) {
    fbi_row_impulse(w, system, body, r, w->mu[r]);
  }
}

/* Do the rows that were left out of the factors hold, c + Q mu = 0, to the tolerance of near-singular positions? */
static fb_status fbi_rows_check(fb_system_work *w, const fb_system *system, const fb_body *body)
{
  const fb_real tol = FB_SINGLE ? FB_R(0.1) : FB_R(0.01);
  const int m = w->n_row;
  fbi_ends_move(w, system, body);
  for (int k = w->rank; k < m; k++) {
    const int r = w->order[k];
    const fbi_row *row = &w->row[r];
    fb_real miss = w->c[r], drift;
    for (int i = 0; i < m; i++) {
      miss += w->Q[r * m + i] * w->mu[i];
    }
    (void)fbi_row_drift(&drift, w, row, (const fb_real(*)[3])row->r.force);
    if (FB_FABS(miss) > tol * (fbi_row_size(row, w) + drift)) {
      w->joint = row->joint;
      return FB_ERR_CONTRADICTION;
    }
  }
  return FB_OK;
}

/* [E9.10] Speeds under constraints, M u = p + A^T mu with A u + c = 0: solves with the right-hand side as it is, then
   with the impulses mu added. c: terms of the rows other than A u. check: tests rows that were left out, which
   prescribed speeds or a c other than zero may contradict.
   Source: Lagrange multipliers of the momenta; [H] 3.5.  Fails: FB_ERR_CONTRADICTION, the joint of a row left out
   whose velocity constraint is not met.  Test: the_three_methods_agree, contradictions_name_their_joint. */
static FBI_NOINLINE fb_status fbi_constrained_solve(fb_system_work *w, const fb_system *system, const fb_body *body,
                                                    int check)
{
  int given = fbi_rhs_save(w, system, body); /* a right-hand side that rows left out can contradict? */

  /* c + A u without impulses */
  fb_status status = fbi_speeds_solve(w, system, body);
  fbi_ends_move(w, system, body);
  for (int r = 0; r < w->n_row; r++) {
    given |= FB_FABS(w->c[r]) > FB_R(0.0); /* no shortcut if zero: the work must not depend on values */
    w->c[r] += fbi_row_eval(&w->row[r], w);
  }

  /* Q mu = -(c + A u); the solution again, with the impulses */
  status = status == FB_OK ? fbi_rows_factor(w, system, body) : status;
  if (status != FB_OK) {
    return status;
  }
  fbi_rows_multipliers(w);
  fbi_rhs_push(w, system, body);
  status = fbi_speeds_solve(w, system, body);
  if (status == FB_OK && w->rank < w->n_row && given && check) { /* the rank first: a step's work depends on no value */
    status = fbi_rows_check(w, system, body);
  }
  return status;
}

/* ---- rates */

/* Joint momenta along the joint's axes; the state of a free or spherical joint has them in inertial axes. */
static void fbi_joint_momenta(fb_real p[6], const fbi_link_work *L, const fb_joint *joint, const fb_link_state *x)
{
  if (joint->kind == FB_JOINT_FREE) {
    fb_mat33_mulT_vec3(p, L->k.R, x->p);
    fb_mat33_mulT_vec3(p + 3, L->k.R, x->p + 3);
  } else if (joint->kind == FB_JOINT_SPHERICAL) {
    fb_real h[3];
    fb_mat33_mulT_vec3(h, L->k.R, x->p);
    fb_mat33_mulT_vec3(p, joint->child_axes, h);
  } else {
    fbi_copy(p, x->p, joint->n_axis);
  }
}

/* The inverse: joint momenta into the state. */
static void fbi_joint_momenta_set(fb_link_state *x, const fbi_link_work *L, const fb_joint *joint, const fb_real p[6])
{
  if (joint->kind == FB_JOINT_FREE) {
    fb_mat33_mul_vec3(x->p, L->k.R, p);
    fb_mat33_mul_vec3(x->p + 3, L->k.R, p + 3);
  } else if (joint->kind == FB_JOINT_SPHERICAL) {
    fb_real h[3];
    fb_mat33_mul_vec3(h, joint->child_axes, p);
    fb_mat33_mul_vec3(x->p, L->k.R, h);
  } else {
    fbi_copy(x->p, p, joint->n_axis);
  }
}

/* y += s times the velocity of the link's tree frame, body axes. */
static void fbi_own_frame_add(fb_real y[3], fb_real s, const fb_system_work *w, int k)
{
  const fbi_link_work *L = &w->link[k];
  fb_real v[3];
  fb_mat33_mulT_vec3(v, L->k.R, w->link[L->root].frame);
  fbi_vec3_add(y, s, v);
}

/* Right-hand side of E9.5: the momenta of the state, or the speeds of axes that are prescribed. */
static void fbi_rhs_momenta(fb_system_work *w, const fb_system *system, const fb_system_state *state,
                            const fb_system_input *input)
{
  static const fb_real none[6] = {0};
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *L = &w->link[k];
    const fb_joint *joint = L->joint;
    const fb_link_state *x = &state->link[k];

    /* momenta; w->owns: the angular momentum of free roots in body axes, from L->own */
    fbi_vec6_zero(L->y);
    fbi_copy(L->pi, x->pi, L->model->n);
    if (w->owns && joint->kind == FB_JOINT_FREE) {
      fb_mat33_mulT_vec3(L->p, L->k.R, x->p);
      fbi_vec3_copy(L->p + 3, L->own);
    } else {
      fbi_joint_momenta(L->p, L, joint, x);
    }

    /* prescribed speeds, of a free joint relative to the tree's frame */
    if (joint->kind == FB_JOINT_FREE && L->mode[0] == FB_AXIS_PRESCRIBED) {
      fbi_copy(L->p, input ? input->drive[k].rate : none, 6);
      fbi_own_frame_add(L->p, -FB_R(1.0), w, k);
    }
    for (int i = 0; i < joint->n_axis && joint->kind != FB_JOINT_FREE; i++) {
      if (L->mode[i] == FB_AXIS_PRESCRIBED) {
        L->p[i] = input ? input->drive[k].rate[i] : FB_R(0.0);
      }
    }
  }
}

/* Sets prescribed coordinates to their values. */
static void fbi_prescribe(fb_system_state *state, const fb_system *system, const fb_system_work *w,
                          const fb_system_state *modes, const fb_system_input *input)
{
  for (int k = 0; k < system->n_body; k++) {
    const fb_joint *joint = fbi_link_joint(system, w, k);
    const int axes = joint->kind == FB_JOINT_FREE || joint->kind == FB_JOINT_SPHERICAL ? 0 : joint->n_axis;
    for (int i = 0; i < axes; i++) {
      if (modes->mode[k][i] == FB_AXIS_PRESCRIBED) {
        state->link[k].x[i] = input ? input->drive[k].value[i] : FB_R(0.0);
      }
    }
  }
}

static fb_status fbi_system_input_check(const fb_system *system, const fb_body *body, const fb_system_input *input)
{
  if (!input) {
    return FB_OK;
  }
  FBI_REQUIRE(input->n_load >= 0 && input->n_load <= FB_MAX_LOADS, FB_ERR_CAPACITY);
  for (int i = 0; i < input->n_load; i++) {
    const fb_system_load *load = &input->load[i];
    FBI_REQUIRE(load->body >= 0 && load->body < system->n_body, FB_ERR_CAPACITY);
    FBI_REQUIRE(load->load.node >= 0 && load->load.node < fbi_model(system, body, load->body)->n_node, FB_ERR_CAPACITY);
    FBI_REQUIRE(fbi_is_choice((int)load->load.axes, (int)FB_AXES_COUNT - 1), FB_ERR_VALUE);
  }

  /* Motors: where there is none, a torque would do nothing */
  for (int j = 0; j < system->n_body + system->n_loop; j++) {
    const fb_joint *joint = &system->joint[j];
    for (int i = joint->kind == FB_JOINT_FREE ? 0 : joint->n_axis; i < 3; i++) {
      if (!(input->drive[j].torque[i] == FB_R(0.0))) {
        return FBI_REFUSE(FB_ERR_VALUE, "drive: torque of an axis without motor, equal to", j,
                          input->drive[j].torque[i], FB_R(0.0));
      }
    }
  }
  return FB_OK;
}

/* Positions, velocities and impulses at a state: E9.2, E9.5, E9.10. lazy: q_dot of modes that carry no children is
   left to fbi_link_inertia. */
static fb_status fbi_system_velocity(fb_system_work *w, const fb_system *system, const fb_body *body,
                                     const fb_system_state *state, const fb_system_state *modes,
                                     const fb_system_input *input, int lazy)
{
  fb_status status;

  /* poses, factors, right-hand side */
  fbi_links_place(w, system, body, state, modes);
  status = fbi_mass_factor(w, system, body, FB_R(0.0));
  if (status != FB_OK) {
    return status;
  }
  fbi_rhs_momenta(w, system, state, input);

  /* with constraint rows */
  w->n_row = w->n_end = 0;
  if (system->n_loop > 0 || w->kept || (input && input->rows)) {
    status = fbi_rows_fill(w, system, body, modes, input);
    for (int r = 0; r < w->n_row && status == FB_OK; r++) { /* after a failure the last one may have no end */
      fb_real size;
      w->c[r] = w->row[r].r.b + fbi_row_drift(&size, w, &w->row[r], (const fb_real(*)[3])w->row[r].r.force);
    }
    status = status == FB_OK ? fbi_constrained_solve(w, system, body, 1) : status;
    return status == FB_OK ? fbi_rows_rate(w, system, body, input) : status;
  }

  /* without constraint rows */
  for (int k = 0; k < system->n_body; k++) {
    w->link[k].has_speeds = w->link[k].open || !lazy || system->method == FB_METHOD_DENSE;
  }
  return fbi_speeds_solve(w, system, body);
}

/* Input of a body's own kernels: k.V, and k.pb = M^-1 pi of the body alone, q_dot + M^-1 Lambda^T V. */
static void fbi_link_kinetics(fbi_link_work *L, const fb_body *body)
{
  fbi_vec6_copy(L->k.V, L->V);
  L->k.pb = L->k.Minv_pi;
  if (body->n > 0) {
    fb_real e[FB_MAX_MODES], unused[FB_MAX_MODES + 1] = {0};
    fbi_zero(e, body->n);
    fbi_lambda_gradients(e, unused, body, L->V, L->k.qx, L->q_dot);
    fbi_mass_solve(L->k.Minv_pi, body, e);
    for (int a = 0; a < body->n; a++) {
      L->k.Minv_pi[a] = L->q_dot[a] - L->k.Minv_pi[a];
    }
  }
}

/* k.x, the forces of the body's own inertia on its modes (E8.17), and its kinetics as above. For modes that carry no
   children the solution has left pb in L->e; q_dot is then found here. */
static void fbi_link_inertia(fbi_link_work *L, const fb_body *body)
{
  if (body->n > 0) {
    if (L->has_speeds) {
      fbi_link_kinetics(L, body);
    } else {
      L->k.pb = L->e;
    }

    /* forces by Lambda */
    fbi_zero(L->k.x, body->n + 1);
    fbi_zero(L->k.e, body->n);
    fbi_lambda_gradients(L->k.e, L->k.x, body, L->V, L->k.qx, L->k.pb);

    /* q_dot, if not known */
    if (!L->has_speeds) {
      fbi_mass_solve(L->q_dot, body, L->k.e);
      for (int a = 0; a < body->n; a++) {
        L->q_dot[a] += L->e[a];
      }
    }
#if FBI_WITH_SHAPE_INERTIA
    if (!body->constant_S) {
      fbi_S_gradient(L->k.x, body, L->V, L->k.qx);
    }
#endif
  }
}

/* Forces on all bodies by their own inertia, gravity and loads: k.fg and k.x. */
static void fbi_system_loads(fb_system_work *w, const fb_system *system, const fb_body *body,
                             const fb_system_input *input)
{
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *L = &w->link[k];
    fbi_link_inertia(L, L->model);
    fbi_vec6_zero(L->k.fg);
#if FB_WITH_GRAVITY
    if (fbi_has(L->model->effects, FB_EFFECT_GRAVITY)) {
      fbi_gravity_add(&L->k, L->model);
    }
#endif
  }
  for (int i = 0; input && i < input->n_load; i++) {
    fbi_link_work *L = &w->link[input->load[i].body];
    fbi_load_add(&L->k, fbi_model(system, body, input->load[i].body), &input->load[i].load, L->k.qx + 1);
  }
}

/* [E9.11] Effort of motor, spring and damper on axis i: tau = motor - k (x - rest) - c u; on a spherical joint -k
   times the rotation vector, the gradient of k phi.phi/2.
   Source: definition.  Test: springs_and_dampers_balance_energy. */
static fb_real fbi_axis_torque(const fb_joint *joint, const fb_system_input *input, int j, int i, fb_real value,
                               fb_real speed)
{
  const fb_real motor = input ? input->drive[j].torque[i] : FB_R(0.0);
  return motor - joint->stiffness[i] * (value - joint->rest[i]) - joint->damping[i] * speed;
}

/* Has joint j a spring, a damper or a motor at work? */
static int fbi_is_sprung(const fb_joint *joint, const fb_system_input *input, int j)
{
  fb_real sum = FB_R(0.0);
  for (int i = 0; i < joint->n_axis && i < 3; i++) {
    sum += joint->stiffness[i] + joint->damping[i] + (input ? FB_FABS(input->drive[j].torque[i]) : FB_R(0.0));
  }
  return sum > FB_R(0.0);
}

/* Speed of a joint from its frames: relative motion of the child in the direction (force, torque). */
static fb_real fbi_frames_speed(const fbi_frames *f, const fb_system_work *w, const fb_real force[3],
                                const fb_real torque[3])
{
  fb_real v[3], turn[3];
  fbi_vec3_copy(v, f->end[1]->v);
  fbi_vec3_add_cross(v, f->end[1]->w, f->arm[1]);
  fbi_vec3_add(v, -FB_R(1.0), f->end[0]->v);
  fbi_vec3_add_cross(v, f->arm[0], f->end[0]->w); /* - w x arm */
  fbi_frames_apart_add(v, FB_R(1.0), w, f->end[0]->link, f->end[1]->link, 1);
  for (int i = 0; i < 3; i++) {
    turn[i] = f->end[1]->w[i] - f->end[0]->w[i];
  }
  return fb_vec3_dot(force, v) + fb_vec3_dot(torque, turn);
}

/* Loads of springs, dampers and motors of joints enforced by multipliers; returns the power of the motors. */
static FBI_NOINLINE fb_real fbi_kept_springs(fb_system_work *w, const fb_system *system, const fb_body *body,
                                             const fb_system_state *modes, const fb_system_input *input)
{
  fb_real power = FB_R(0.0);
  for (int j = 0; j < system->n_body + system->n_loop; j++) {
    const fb_joint *joint = &system->joint[j];
    fbi_frames f;
    fb_real value[3];
    if (!fbi_is_kept(system, w, j) || !fbi_is_sprung(joint, input, j)) {
      continue;
    }

    /* coordinates */
    (void)fbi_frames_eval(&f, w, system, body, j);
    fbi_frames_value(value, &f, joint);
    for (int i = 0; i < joint->n_axis; i++) {
      fb_real force[3], torque[3], speed, tau;
      if (modes->mode[j][i] != FB_AXIS_FREE) {
        continue;
      }

      /* effort and power */
      fbi_frames_axis(force, torque, &f, joint, i);
      speed = fbi_frames_speed(&f, w, force, torque);
      tau = fbi_axis_torque(joint, input, j, i, value[i], speed);
      power += (input ? input->drive[j].torque[i] : FB_R(0.0)) * speed;

      /* on the child, and the reaction on the parent */
      for (int s = 0; s < 2; s++) {
        fb_real moment[3];
        fb_vec3_cross(moment, f.arm[s], force);
        fbi_vec3_add(moment, FB_R(1.0), torque);
        if (f.end[s]->link >= 0) {
          fbi_link_work *L = &w->link[f.end[s]->link];
          fbi_end_push(L->k.fg, L->k.x + 1, L, f.end[s], fbi_model(system, body, f.end[s]->link)->n,
                       s == 0 ? -tau : tau, force, moment);
        }
      }
    }
  }
  return power;
}

/* [E9.12] Generalized force on the modes of a body by what a node carries that they move: with the momentum G and load
   F of that about the node, body axes,
   pi_dot_a += J_a.(F - turning of G) + J_dot_a.G,  turning: the transport term (w x p, w x h + v_n x p) with v_n of
   the node, w of the body.
   Source: d/dt of pi_a = pi_own,a + J_a.G.  Cost: 40 n flops, with a quadratic field 24 n^2.  Fails: never.
   Test: systems_keep_energy_and_momentum. */
static FBI_NOINLINE void fbi_node_take(fb_real *x, const fbi_node_field *f, const fb_body *body, const fb_node *node,
                                       const fb_real *q_dot, const fb_real V[6], const fb_real n[3], const fb_real G[6],
                                       const fb_real F[6])
{
  const fb_real scale = FB_R(1.0) / (FB_R(1.0) + FB_R(0.25) * fb_vec3_dot(f->phi, f->phi));
  fb_real Ju_dot[3 * FB_MAX_MODES], turn_dot[3 * FB_MAX_MODES], at[6], turn[6], load[6], phi_dot[3], shrink;

  /* velocity of the node, rates of its rotation parameters phi and of their gradients */
  fbi_vec6_copy(at, V);
  fbi_vec3_add_cross(at, V + 3, n);
  fbi_node_rates(Ju_dot, turn_dot, body, node, q_dot);
  fbi_vec3_zero(phi_dot);
  for (int a = 0; a < body->n; a++) {
    fbi_vec3_add(at, q_dot[a], f->Ju + 3 * a);
    fbi_vec3_add(phi_dot, q_dot[a], f->turn + 3 * a);
  }
  shrink = FB_R(0.5) * fb_vec3_dot(f->phi, phi_dot);

  /* F - turning */
  fbi_turning(turn, at, G);
  for (int i = 0; i < 6; i++) {
    load[i] = F[i] - turn[i];
  }

  /* J_a.(F - turning) + J_dot_a.G; rate: J_dot_a of the rotation */
  for (int a = 0; a < body->n; a++) {
    fb_real rate[3];
    fb_vec3_cross(rate, phi_dot, f->turn + 3 * a);
    fbi_vec3_add_cross(rate, f->phi, turn_dot + 3 * a);
    for (int i = 0; i < 3; i++) {
      rate[i] = scale * (turn_dot[3 * a + i] + FB_R(0.5) * rate[i] - shrink * f->Jphi[3 * a + i]);
    }
    x[a] += fb_vec3_dot(f->Ju + 3 * a, load) + fb_vec3_dot(f->Jphi + 3 * a, load + 3) + fb_vec3_dot(Ju_dot + 3 * a, G) +
            fb_vec3_dot(rate, G + 3);
  }
}

/* [E9.13] Loads by the rows' impulses, which are momentum outside of the tree's, -(f, t) at the ends. With mu constant
   it changes by the directions alone: loads -(f_dot, t_dot + v x f); p_dot loses A_dot^T mu.
   Source: d/dt of p + A^T mu.  Fails: never.  Test: the_three_methods_agree. */
static FBI_NOINLINE void fbi_rows_loads(fb_system_work *w, const fb_system *system, const fb_body *body)
{
  for (int r = 0; r < w->n_row; r++) {
    const fbi_row *row = &w->row[r];
    const fb_real mu = w->mu[r];
    for (int s = 0; s < 2; s++) {
      const fbi_end *end = &w->end[row->end[s]];
      fbi_link_work *L = end->link >= 0 ? &w->link[end->link] : NULL;
      fb_real G[6], F[6], twist[3];
      if (!L) {
        continue;
      }

      /* momentum G and load F at the node, body axes */
      fbi_vec3_copy(twist, row->torque_dot[s]);
      fbi_vec3_add_cross(twist, end->v, row->r.force[s]);
      fb_mat33_mulT_vec3(G, L->k.R, row->r.force[s]);
      fb_mat33_mulT_vec3(G + 3, L->k.R, row->r.torque[s]);
      fb_mat33_mulT_vec3(F, L->k.R, row->force_dot[s]);
      fb_mat33_mulT_vec3(F + 3, L->k.R, twist);
      for (int i = 0; i < 6; i++) {
        G[i] *= -mu;
        F[i] *= -mu;
      }

      /* on the modes; on the body about O */
      if (end->moves) {
        const fb_body *model = fbi_model(system, body, end->link);
        fbi_node_take(L->k.x + 1, &end->f, model, &model->node[end->node], L->q_dot, L->V, end->n, G, F);
      }
      fbi_vec3_add_cross(F + 3, end->n, F);
      fbi_vec6_add(L->F, FB_R(1.0), F);
    }
  }
}

/* Rates of a joint's coordinates. The position of a free joint, relative to the tree's frame, is in lost_x. */
static void fbi_coordinate_rates(fb_link_state *rate, const fbi_link_work *L, const fb_joint *joint,
                                 const fb_link_state *x)
{
  if (joint->kind == FB_JOINT_FREE) {
    fb_mat33_mul_vec3(rate->lost_x, L->k.R, L->V);
    fbi_quat_rate(rate->quat, x->quat, L->V + 3);
  } else if (joint->kind == FB_JOINT_SPHERICAL) {
    fbi_quat_rate(rate->quat, x->quat, L->u);
  } else {
    for (int i = 0; i < joint->n_axis; i++) {
      rate->x[i] = L->u[i];
    }
  }
}

/* [E9.14] Rates of a joint's momenta, p_i = A_i.G: p_i_dot = tau_i + A_i.(F - turning of G) + A_dot_i.G in body axes,
   turning: the transport term (w x p, w x h + v x p). Momenta in inertial axes have none:
   P_dot = R F, L_dot = R T - v x P. Returns the power of the motors.
   Source: d/dt of A_i.G, G_dot = F - turning + joint reaction.  Cost: 60 flops.  Fails: never.
   Test: systems_keep_energy_and_momentum, every_joint_moves_as_it_should. */
static fb_real fbi_momentum_rate(fb_link_state *rate, const fbi_link_work *L, const fb_joint *joint,
                                 const fb_link_state *x, const fb_system_input *input, int k)
{
  fb_real turn[6], load[6], tau[3] = {0}, power = FB_R(0.0);

  /* free joint: inertial axes */
  if (joint->kind == FB_JOINT_FREE) {
    if (L->mode[0] == FB_AXIS_FREE) {
      fb_mat33_mul_vec3(rate->p, L->k.R, L->F);
      fb_mat33_mul_vec3(rate->p + 3, L->k.R, L->F + 3);
      fbi_vec3_add_cross(rate->p + 3, x->p, rate->lost_x);
    } else {
      fbi_vec6_zero(rate->p);
    }
    return power;
  }

  /* F - turning */
  fbi_turning(turn, L->V, L->G);
  fbi_vec6_copy(load, L->F);
  fbi_vec6_add(load, -FB_R(1.0), turn);

  /* effort and load along each free axis */
  for (int i = 0; i < joint->n_axis; i++) {
    const fb_real *A = L->A + 6 * i;
    rate->p[i] = FB_R(0.0);
    if (L->mode[i] == FB_AXIS_FREE) {
      fb_real phi[3], value = x->x[i];
      if (joint->kind == FB_JOINT_SPHERICAL) {
        fb_quat_to_rotvec(phi, x->quat);
        value = phi[i];
      }
      tau[i] = fbi_axis_torque(joint, input, k, i, value, L->u[i]) + fbi_vec6_dot(A, load);
      power += (input ? input->drive[k].torque[i] : FB_R(0.0)) * L->u[i];
      rate->p[i] = tau[i];
    }
  }

  /* universal: A_dot of the first axis */
  if (joint->kind == FB_JOINT_UNIVERSAL && L->mode[0] == FB_AXIS_FREE) {
    rate->p[0] += L->u[1] * fbi_vec6_dot(L->A_dot, L->G);
  }

  /* spherical: inertial axes */
  if (joint->kind == FB_JOINT_SPHERICAL && L->mode[0] == FB_AXIS_FREE) {
    fb_real body[3], h[3];
    fb_mat33_mul_vec3(body, joint->child_axes, tau);
    fb_mat33_mulT_vec3(h, L->k.R, x->p);
    fbi_vec3_add_cross(body, L->V + 3, h);
    fb_mat33_mul_vec3(rate->p, L->k.R, body);
  }
  return power;
}

/* Transmits F and G of a body to its parent: F to its load, both to the modes that move the node. */
static void fbi_load_hand_in(const fbi_link_work *L)
{
  const fb_joint *joint = L->joint;
  fbi_link_work *parent = L->parent;
  if (!parent) {
    return;
  }
  if (joint->moves) {
    const fb_body *on = parent->model;
    fb_real F[6] = {0}, G[6] = {0};
    fbi_to_parent_add(F, L, L->F);
    fbi_to_parent_add(G, L, L->G);
    fbi_node_take(parent->k.x + 1, &L->node, on, &on->node[joint->parent_node], parent->q_dot, parent->V, L->n, G, F);
    fbi_vec3_add_cross(F + 3, L->n, F);
    fbi_vec6_add(parent->F, FB_R(1.0), F);
  } else {
    fbi_to_parent_add(parent->F, L, L->F);
  }
}

/* [E9.15] Rates of a system: velocities (E9.5, E9.10), loads summed from the tips, momenta (E9.14), modes (E8.17).
   Source: THEORY.md 9.1.  Fails: see the header.  Test: systems_keep_energy_and_momentum,
   the_three_methods_agree. */
static FBI_FLATTEN fb_status fbi_system_rates(fb_system_work *w, const fb_system *system, const fb_body *body,
                                              fb_system_state *rate, const fb_system_state *state,
                                              const fb_system_state *modes, const fb_system_input *input)
{
  const fb_status status = fbi_system_velocity(w, system, body, state, modes, input, 1);
  if (status != FB_OK) {
    return status;
  }

  /* forces on the bodies: loads, springs, impulses of the rows */
  fbi_system_loads(w, system, body, input);
  rate->motor_work = w->kept || system->n_loop > 0 ? fbi_kept_springs(w, system, body, modes, input) : FB_R(0.0);
  for (int k = 0; k < system->n_body; k++) {
    fbi_vec6_copy(w->link[k].F, w->link[k].k.fg);
  }
  fbi_rows_loads(w, system, body);

  /* from the tips: rates of joint and modes, loads to the parent */
  for (int k = system->n_body - 1; k >= 0; k--) {
    fbi_link_work *L = &w->link[k];
    const fb_body *model = L->model;
    fb_link_state *out = &rate->link[k];
    fbi_coordinate_rates(out, L, L->joint, &state->link[k]);
    rate->motor_work += fbi_momentum_rate(out, L, L->joint, &state->link[k], input, k);
    fbi_load_hand_in(L);
    if (model->n > 0) {
      fbi_copy(out->q, L->q_dot, model->n);
      fbi_elastic_forces(out->pi, &L->k, model, state->link[k].q, L->q_dot);
    }
  }
  return FB_OK;
}

/* ---- states, motion, energy, momentum */

/* Prepares the work struct at the start of a call. */
static void fbi_system_enter(fb_system_work *w, const fb_system *system)
{
  w->kept = system->method == FB_METHOD_MULTIPLIERS;
  w->heavy = w->clock = FB_R(0.0);
  w->owns = 0;
  w->joint = -1;
  w->n_row = w->n_end = 0;
}

/* [E9.16] Momenta at the present velocities: each body's own (p, h) and pi; G of the subtrees by summation; p_i =
   A_i.G, pi_a + J_a.G.
   Source: definition of the conjugate momenta.  Fails: never.  Test: momenta_give_back_the_speeds. */
static void fbi_momenta_fill(fb_system_state *state, fb_system_work *w, const fb_system *system, const fb_body *body)
{
  /* momenta of each body by itself */
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *L = &w->link[k];
    const fb_body *model = fbi_model(system, body, k);
    fbi_link_kinetics(L, model);
    fbi_momenta(&L->k, model);
    fbi_vec6_copy(L->b, L->k.ph);
    fbi_mass_mul(L->e, model, L->k.pb);
    for (int a = 0; a < model->n; a++) {
      L->e[a] = -L->e[a]; /* fbi_hand_in subtracts from e */
    }
  }

  /* sums from the tips, along the joint's axes */
  for (int k = system->n_body - 1; k >= 0; k--) {
    fbi_link_work *L = &w->link[k];
    const fb_joint *joint = fbi_link_joint(system, w, k);
    fb_link_state *x = &state->link[k];
    fb_real p[6];
    fbi_hand_in_at(w, system, body, k);
    fbi_vec6_zero(x->p);
    for (int a = 0; a < fbi_model(system, body, k)->n; a++) {
      x->pi[a] = -L->e[a];
    }
    fbi_vec6_copy(p, L->b);
    for (int i = 0; i < joint->n_axis && joint->kind != FB_JOINT_FREE; i++) {
      p[i] = fbi_vec6_dot(L->A + 6 * i, L->b);
    }
    fbi_joint_momenta_set(x, L, joint, p);
  }
}

/* ---- frames of flying trees */

/* Is there a tree whose frame may move? */
static int fbi_flies(const fb_system *system, const fb_system_work *w)
{
  int flies = w->kept;
  for (int k = 0; k < system->n_body; k++) {
    flies |= system->joint[k].kind == FB_JOINT_FREE;
  }
  return flies;
}

/* x += d with compensation: lost collects the round-off and passes on to x what x can hold. Source: Knuth's two-sum. */
static void fbi_keep(fb_real *x, fb_real *lost, const fb_real *d, int n)
{
  for (int i = 0; i < n; i++) {
    const fb_real a = x[i], sum = a + d[i], b = sum - a, rest = lost[i] + ((a - (sum - b)) + (d[i] - b));
    x[i] = sum + rest;
    lost[i] = rest - (x[i] - sum);
  }
}

/* [E9.24] Momenta of a body by a velocity d of the whole tree (body axes): linear m d and angular c(q) x d in F,
   Lambda^T d in e of its modes; c: its first moment. Without residual inertia F follows from S0 and Lambda as in the
   equations of motion, so that solving them returns the velocity d.
   Source: definition of the momenta, E8.16 with g = d.  Cost: 8 flops a term.  Test: flight_speed_changes_nothing. */
static void fbi_drift_momenta(fb_real F[6], fb_real *e, fb_real c[3], const fbi_link_work *L, const fb_body *body,
                              const fb_real d[3])
{
  fb_real x[FB_MAX_MODES + 1];
  fbi_zero(x, body->n + 1);
  fbi_pull_eval(c, x, body, L->k.qx, d);
  fbi_copy(e, x + 1, body->n);
  if (body->constant_S && body->n > 0) {
    const fb_real V[6] = {d[0], d[1], d[2], FB_R(0.0), FB_R(0.0), FB_R(0.0)};
    fb_real elastic[6] = {0}, pb[FB_MAX_MODES];
    fbi_mass_solve(pb, body, e);
    fb_sym6_mul_vec6(F, body->S0, V);
    fbi_lambda_sub(elastic, body, L->k.qx, pb);
    fbi_vec6_add(F, -FB_R(1.0), elastic);
  } else {
    for (int i = 0; i < 3; i++) {
      F[i] = body->mass * d[i];
    }
    fb_vec3_cross(F + 3, c, d);
  }
}

/* [E9.22] Mass and first moment of the subtree of each joint, L->bulk and first, of the placed system; change: also
   the momenta of each body by the change of its tree's frame (E9.24), in L->b and L->e.
   Source: definition.  Cost: 60 flops a body, 8 a term.  Test: flight_speed_changes_nothing. */
static void fbi_trees_weigh(fb_system_work *w, const fb_system *system, int change)
{
  /* each body by itself */
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *L = &w->link[k];
    const fb_body *model = L->model;
    L->bulk = model->mass;
    if (change) {
      fb_real d[3];
      fb_mat33_mulT_vec3(d, L->k.R, w->link[L->root].change);
      fbi_drift_momenta(L->b, L->e, L->first, L, model, d);
    } else {
      fbi_center_eval(L->first, model, L->k.qx + 1);
    }
  }

  /* sums from the tips */
  for (int k = system->n_body - 1; k >= 0; k--) {
    const fbi_link_work *L = &w->link[k];
    fbi_link_work *parent = L->parent;
    if (parent) {
      fb_real first[3];
      fb_mat33_mul_vec3(first, L->C, L->first);
      fbi_vec3_add(parent->first, FB_R(1.0), first);
      fbi_vec3_add(parent->first, L->bulk, L->s);
      parent->bulk += L->bulk;
    }
  }
}

/* [E9.23] Subtracts the change of the tree frames from all momenta, A.(m d, c x d) of each joint's subtree: the same
   as the impulse of a uniform gravity field. After E9.22.
   Source: p = M u, linear in velocities.  Cost: 80 flops a body.  Test: flight_speed_changes_nothing. */
static void fbi_momenta_reframe(fb_system_state *into, fb_system_work *w, const fb_system *system)
{
  for (int k = system->n_body - 1; k >= 0; k--) {
    fbi_link_work *L = &w->link[k];
    const fb_joint *joint = w->link[k].joint;
    fbi_link_work *parent = L->parent;
    fb_link_state *x = &into->link[k], change;
    fb_real p[6];

    /* off the momenta of joint and modes */
    fbi_vec6_copy(p, L->b);
    for (int i = 0; i < joint->n_axis && joint->kind != FB_JOINT_FREE; i++) {
      p[i] = fbi_vec6_dot(L->A + 6 * i, L->b);
    }
    fbi_joint_momenta_set(&change, L, joint, p);
    fbi_row_sub(x->p, FB_R(1.0), change.p, joint->n_axis);
    fbi_row_sub(x->pi, FB_R(1.0), L->e, w->link[k].model->n);

    /* subtree: to the parent and its modes */
    if (parent && joint->moves) {
      fb_real b[6] = {0};
      fbi_to_parent_add(b, L, L->b);
      for (int a = 0; a < parent->model->n; a++) {
        parent->e[a] += fb_vec3_dot(L->node.Ju + 3 * a, b) + fb_vec3_dot(L->node.Jphi + 3 * a, b + 3);
      }
      fbi_vec3_add_cross(b + 3, L->n, b);
      fbi_vec6_add(parent->b, FB_R(1.0), b);
    } else if (parent) {
      fbi_to_parent_add(parent->b, L, L->b);
    }
  }
}

/* Are both ends of a row on the same tree? */
static int fbi_row_is_inner(const fb_system_work *w, const fbi_row *row)
{
  const int a = w->end[row->end[0]].link, b = w->end[row->end[1]].link;
  return a >= 0 && b >= 0 && w->link[a].root == w->link[b].root;
}

/* Sets held of each tree's root. 1: constraint forces from outside act on the tree, or its root is locked or
   prescribed. 2: they come from the ground or a tree on it; the tree's frame stands still. 2 also where a flexible
   body lacks residual inertia: its momenta do not contain the motion of the mass center, and its equations conserve
   angular momentum only in a frame at rest. */
static void fbi_trees_hold(fb_system_work *w, const fb_system *system, const fb_system_state *modes)
{
  for (int k = 0; k < system->n_body; k++) {
    w->link[k].held = 0;
  }

  /* missing residual inertia; locked or prescribed roots */
  for (int k = 0; k < system->n_body; k++) {
    const fb_body *model = w->link[k].model;
    fbi_link_work *root = &w->link[w->link[k].root];
    if (model->n > 0 && !fbi_has(model->effects, FB_EFFECT_RESIDUAL_INERTIA)) {
      root->held = 2;
    } else if (system->joint[k].kind == FB_JOINT_FREE && modes->mode[k][0] != FB_AXIS_FREE) {
      root->held = root->held == 2 ? 2 : 1;
    }
  }

  /* constraint rows with a force from outside the tree */
  for (int r = 0; r < w->n_row; r++) {
    const fbi_row *row = &w->row[r];
    fb_real sum[3];
    for (int i = 0; i < 3; i++) {
      sum[i] = row->r.force[0][i] + row->r.force[1][i];
    }
    for (int s = 0; s < 2; s++) {
      const int link = w->end[row->end[s]].link, other = w->end[row->end[1 - s]].link;
      const int pushes = fbi_vec3_norm(row->r.force[s]) > FB_R(0.0);
      fbi_link_work *root = link >= 0 ? &w->link[w->link[link].root] : NULL;
      if (root && pushes && (!fbi_row_is_inner(w, row) || fbi_vec3_norm(sum) > FB_R(0.0))) {
        const int ground = other < 0 || fbi_link_joint(system, w, w->link[other].root)->kind != FB_JOINT_FREE;
        root->held = ground || root->held == 2 ? 2 : 1;
      }
    }
  }
}

/* Mass and linear momentum of each free tree, of a state whose momenta are to grow by those of more (NULL: by none). */
static void fbi_trees_sum(fb_system_work *w, const fb_system *system, const fb_system_state *state,
                          const fb_system_state *more)
{
  for (int k = 0; k < system->n_body; k++) {
    w->link[k].total = FB_R(0.0);
    fbi_vec3_zero(w->link[k].impulse);
    fbi_vec3_zero(w->link[k].change);
  }

  /* masses of bodies, momenta of free roots */
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *root = &w->link[w->link[k].root];
    root->total += w->link[k].model->mass;
    if (w->link[k].joint->kind == FB_JOINT_FREE) {
      fbi_vec3_add(root->impulse, FB_R(1.0), state->link[k].p);
      if (more) {
        fbi_vec3_add(root->impulse, FB_R(1.0), more->link[k].p);
#if FB_SINGLE
        fbi_vec3_add(root->impulse, FB_R(1.0), state->link[k].lost_p);
#endif
      }
    }
  }
}

/* Velocity change of the frame of each free tree: such that the tree has no linear momentum in it. Where the root is
   prescribed the frame moves with the root; where it is locked or tied to the ground the frame stands still. */
static void fbi_frames_choose(fb_system_work *w, const fb_system *system, const fb_system_state *state,
                              const fb_system_state *modes, const fb_system_input *input)
{
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *L = &w->link[k];
    fb_real given[3] = {0};
    int stands = L->held == 2, driven = -1;
    if (w->link[k].joint->kind != FB_JOINT_FREE || L->root != k) {
      continue;
    }

    /* locked and prescribed roots of the tree */
    for (int i = 0; i < system->n_body; i++) {
      if (system->joint[i].kind == FB_JOINT_FREE && w->link[i].root == k) {
        stands |= modes->mode[i][0] == FB_AXIS_LOCKED;
        driven = modes->mode[i][0] == FB_AXIS_PRESCRIBED && driven < 0 ? i : driven;
      }
    }

    /* velocity of the prescribed root */
    if (driven >= 0 && input && !stands) {
      fb_mat33_mul_vec3(given, w->link[driven].k.R, input->drive[driven].rate);
    }

    /* velocity change of the frame */
    for (int i = 0; i < 3; i++) {
      const fb_real own = L->total > FB_R(0.0) ? L->impulse[i] / L->total : FB_R(0.0);
      L->change[i] = stands || driven >= 0 ? given[i] - state->link[k].u[i] - state->link[k].lost_u[i] : own;
    }
  }
}

/* Transforms momenta to the chosen frames: those of the state, or (more) the increments that it is to grow by. The
   linear momentum of a free root becomes exactly zero. */
static void fbi_frames_take(fb_system_work *w, const fb_system *system, fb_system_state *state, fb_system_state *more,
                            const fb_system_state *modes, const fb_system_input *input)
{
  fbi_trees_sum(w, system, state, more);
  fbi_trees_hold(w, system, modes);
  fbi_frames_choose(w, system, state, modes, input);
  fbi_trees_weigh(w, system, 1);
  fbi_momenta_reframe(more ? more : state, w, system);

  /* free roots: exactly zero */
  for (int k = 0; k < system->n_body; k++) {
    fb_real *P = more ? more->link[k].p : state->link[k].p;
    const int rests = !system->tied && system->joint[k].kind == FB_JOINT_FREE && modes->mode[k][0] == FB_AXIS_FREE &&
                      w->link[k].held != 2 && w->link[k].total > FB_R(0.0);
    for (int i = 0; i < 3 && rests; i++) {
      P[i] = more ? -state->link[k].p[i] : FB_R(0.0);
#if FB_SINGLE
      P[i] -= more ? state->link[k].lost_p[i] : FB_R(0.0);
#endif
    }
  }
}

/* Updates u of the state to the velocities of the chosen frames. */
static void fbi_frames_set(fb_system_state *state, fb_system_work *w, const fb_system *system)
{
  fb_real rest[3];
  for (int k = 0; k < system->n_body; k++) {
    fb_link_state *x = &state->link[k];
    if (w->link[k].joint->kind == FB_JOINT_FREE) {
      fbi_keep(x->u, x->lost_u, w->link[w->link[k].root].change, 3);
      for (int i = 0; i < 3; i++) {
        const fb_real lost = FB_FABS(x->lost_u[i]) < FBI_FAINT ? FB_R(0.0) : x->lost_u[i];
        rest[i] = FBI_FAINT + FB_R(4.0) * FB_EPSILON * FB_FABS(w->link[w->link[k].root].change[i]);
        x->lost_u[i] = FB_FABS(x->u[i]) < rest[i] ? FB_R(0.0) : lost;
      }

      /* velocities below round-off become zero; a loop of its own, that it compiles to selections, not branches */
      for (int i = 0; i < 3; i++) {
        x->u[i] = FB_FABS(x->u[i]) < rest[i] ? FB_R(0.0) : x->u[i];
      }
    }
  }
}

/* Moves as much of lost_x into the positions x as they can hold. */
static void fbi_places_settle(fb_system_state *state, const fb_system *system, const fb_system_work *w)
{
  const fb_real none[3] = {0};
  for (int k = 0; k < system->n_body; k++) {
    if (w->link[k].joint->kind == FB_JOINT_FREE) {
      fbi_keep(state->link[k].x, state->link[k].lost_x, none, 3);
    }
  }
}

/* Transforms a state to newly chosen frames of its trees (E9.21): momenta, velocities of the frames, positions. */
static void fbi_frames_renew(fb_system_state *state, fb_system_work *w, const fb_system *system,
                             const fb_system_input *input)
{
  fbi_frames_take(w, system, state, NULL, state, input);
  fbi_frames_set(state, w, system);
  fbi_places_settle(state, system, w);
}

/* Adds s times m c, mass times mass center in the frame, of each tree after E9.22 to its center. */
static void fbi_centers_add(fb_system_work *w, const fb_system *system, fb_real s)
{
  for (int k = 0; k < system->n_body; k++) {
    const fbi_link_work *L = &w->link[k];
    if (w->link[k].joint->parent < 0) {
      fb_real first[3];
      fb_mat33_mul_vec3(first, L->k.R, L->first);
      fbi_vec3_add(w->link[L->root].center, s, first);
      fbi_vec3_add(w->link[L->root].center, s * L->bulk, L->rho);
    }
  }
}

/* Start of a step of free trees, the system placed at its state: records their mass centers. */
static void fbi_flight_begin(fb_system_work *w, const fb_system *system)
{
  for (int k = 0; k < system->n_body; k++) {
    fbi_vec3_zero(w->link[k].glide);
  }
  fbi_trees_weigh(w, system, 0);
  for (int k = 0; k < system->n_body; k++) {
    fbi_vec3_zero(w->link[k].center);
  }
  fbi_centers_add(w, system, FB_R(1.0));
}

/* Shifts the roots of each placed tree to where momentum takes its mass center, m c + P dt, unless it is held. */
static void fbi_centers_lead(fb_system_state *next, fb_system_work *w, const fb_system *system)
{
  fbi_centers_add(w, system, -FB_R(1.0)); /* m c before less m c now */
  for (int k = 0; k < system->n_body; k++) {
    const fbi_link_work *root = &w->link[w->link[k].root];
    fb_link_state *x = &next->link[k];
    if (w->link[k].joint->kind == FB_JOINT_FREE && !root->held && root->total > FB_R(0.0)) {
      fb_real move[3];
      for (int i = 0; i < 3; i++) {
        move[i] = (root->center[i] + root->glide[i]) / root->total;
      }
      fbi_vec3_add(x->lost_x, FB_R(1.0), move);
    }
  }
}

/* V of all bodies from the speeds u and q_dot. */
static void fbi_speeds_out(fb_system_work *w, const fb_system *system, const fb_body *body)
{
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *L = &w->link[k];
    const fb_joint *joint = fbi_link_joint(system, w, k);
    const fbi_link_work *parent = fbi_parent(w, joint);
    fbi_vec6_zero(L->V);
    if (parent) {
      fb_real node[6];
      fbi_node_velocity(node, L, joint, fbi_model(system, body, joint->parent), parent->V, parent->q_dot);
      fbi_from_node(L->V, L, node);
    }
    for (int i = 0; i < joint->n_axis; i++) {
      if (joint->kind == FB_JOINT_FREE) {
        L->V[i] = L->u[i];
      } else {
        fbi_vec6_add(L->V, L->u[i], L->A + 6 * i);
      }
    }
  }
}

/* Displaces the coordinates by the solution (u, q_dot), to close loops. */
static void fbi_state_displace(fb_system_state *state, fb_system_work *w, const fb_system *system, const fb_body *body)
{
  for (int k = 0; k < system->n_body; k++) {
    const fbi_link_work *L = &w->link[k];
    const fb_joint *joint = fbi_link_joint(system, w, k);
    fb_link_state *x = &state->link[k], move;
    fbi_coordinate_rates(&move, L, joint, x);

    /* rotation */
    if (fbi_is_ball(joint->kind)) {
      for (int i = 0; i < 4; i++) {
        x->quat[i] += move.quat[i];
      }
      (void)fb_quat_normalize(x->quat);
    }

    /* position or axes */
    if (joint->kind == FB_JOINT_FREE) {
      fbi_vec3_add(x->lost_x, FB_R(1.0), move.lost_x);
      fbi_vec3_add_cross(x->p + 3, x->p, move.lost_x); /* L about the displaced O */
    } else if (joint->kind != FB_JOINT_SPHERICAL) {
      for (int i = 0; i < joint->n_axis; i++) {
        x->x[i] += move.x[i];
      }
    }

    /* modes */
    fbi_row_sub(x->q, -FB_R(1.0), L->q_dot, fbi_model(system, body, k)->n);
  }
}

static int fbi_has_rows(const fb_system *system, const fb_system_work *w, const fb_system_input *input)
{
  return w->kept || system->n_loop > 0 || (input && input->rows);
}

/* Largest violation of the holonomic rows as last filled, relative to the size of the system; its joint. */
static fb_real fbi_rows_miss(int *worst, const fb_system_work *w, const fb_system *system)
{
  fb_real size = FB_R(1.0), away = FB_R(1.0), miss = FB_R(0.0);
  int joint = -1;

  /* sizes: within the frames, and from the ground */
  for (int k = 0; k < system->n_body; k++) {
    const fbi_link_work *L = &w->link[k];
    const fb_real x[3] = {fbi_true_position(w, k, L->rho, 0), fbi_true_position(w, k, L->rho, 1),
                          fbi_true_position(w, k, L->rho, 2)};
    size = fbi_larger(size, FB_R(1.0) + fbi_vec3_norm(L->rho));
    away = fbi_larger(away, FB_R(1.0) + fbi_vec3_norm(x));
  }

  /* largest violation; of rows within a tree relative to the first of these sizes */
  for (int r = 0; r < w->n_row; r++) {
    const fb_real of = fbi_row_is_inner(w, &w->row[r]) ? size : away;
    const fb_real value = w->row[r].r.holonomic ? FB_FABS(w->row[r].r.value) / of : FB_R(0.0);
    joint = value > miss ? w->row[r].joint : joint;
    miss = fbi_larger(miss, value);
  }
  *worst = joint;
  return miss;
}

/* [E9.17] One Newton step of the positions onto the constraints, along M^-1 A^T: the shortest in the metric of the
   kinetic energy. miss: the largest violation before the step, relative to the size of the system; its joint to
   *worst.
   Source: projection, THEORY.md 9.2.  Cost: E9.9.  Fails: as E9.4.  Test: redundant_loops_are_accepted. */
static fb_status fbi_positions_close(fb_real *miss, int *worst, fb_system_work *w, const fb_system *system,
                                     const fb_body *body, fb_system_state *state, const fb_system_state *modes,
                                     const fb_system_input *input)
{
  fb_status status;
  fbi_links_place(w, system, body, state, modes);
  status = fbi_mass_factor(w, system, body, FB_R(0.0));
  status = status == FB_OK ? fbi_rows_fill(w, system, body, modes, input) : status;
  *miss = status == FB_OK ? fbi_rows_miss(worst, w, system) : FB_R(0.0);
  for (int r = 0; r < w->n_row; r++) {
    w->c[r] = w->row[r].r.holonomic ? w->row[r].r.value : FB_R(0.0);
  }
  fbi_rhs_clear(w, system, body);
  status = status == FB_OK ? fbi_constrained_solve(w, system, body, 0) : status;
  if (status == FB_OK) {
    fbi_state_displace(state, w, system, body);
  }
  return status;
}

/* Restores the momenta of free axes and of modes from before. */
static void fbi_free_momenta_keep(fb_system_state *state, const fb_system_state *before, const fb_system *system,
                                  const fb_system_state *modes)
{
  for (int k = 0; k < system->n_body; k++) {
    const fb_joint *joint = &system->joint[k];
    const int all = fbi_is_ball(joint->kind);
    for (int i = 0; i < joint->n_axis; i++) {
      if (modes->mode[k][all ? 0 : i] == FB_AXIS_FREE) {
        state->link[k].p[i] = before->link[k].p[i];
      }
    }
    memcpy(state->link[k].pi, before->link[k].pi, sizeof state->link[k].pi);
  }
}

/* Projects the velocities onto the constraints: impulses go into the momenta, and axes that are locked or prescribed
   get the momenta of their motion. Without constraints the other momenta stay bit for bit, so that repeated locking
   and release accumulates no round-off. */
static fb_status fbi_momenta_close(fb_system_work *w, const fb_system *system, const fb_body *body,
                                   fb_system_state *state, const fb_system_state *modes, const fb_system_input *input)
{
  const fb_status status = fbi_system_velocity(w, system, body, state, modes, input, 0);
  if (status == FB_OK && fbi_has_rows(system, w, input)) {
    fbi_momenta_fill(state, w, system, body);
  } else if (status == FB_OK) {
    w->sum = *state;
    fbi_momenta_fill(state, w, system, body);
    fbi_free_momenta_keep(state, &w->sum, system, modes);
  }
  return status;
}

static int fbi_link_state_is_finite(const fb_link_state *x, int n)
{
  return fbi_is_finite(x->x, 3) && fbi_is_finite(x->quat, 4) && fbi_is_finite(x->p, 6) && fbi_is_finite(x->q, n) &&
         fbi_is_finite(x->pi, n) && fbi_is_finite(x->u, 3) && fbi_is_finite(x->lost_x, 3) &&
         fbi_is_finite(x->lost_u, 3);
}

/* Finite, and every body within its deflection limit. */
static fb_status fbi_system_range(const fb_system *system, const fb_body *body, const fb_system_state *state)
{
  if (!fbi_is_finite(&state->motor_work, 1)) {
    return FB_ERR_NOT_FINITE;
  }
  for (int k = 0; k < system->n_body; k++) {
    const fb_body *model = fbi_model(system, body, k);
    fb_real deflection = FB_R(0.0);
    if (!fbi_link_state_is_finite(&state->link[k], model->n)) {
      return FB_ERR_NOT_FINITE;
    }
    for (int a = 0; a < model->n; a++) {
      deflection += model->reach[a] * FB_FABS(state->link[k].q[a]);
    }
    if (!(deflection <= model->deflection_limit)) {
      return FB_ERR_RANGE;
    }
  }
  return FB_OK;
}

/* Speeds of a placed tree: of motion (NULL: none) where axes are free, of the input where they are prescribed. */
static void fbi_speeds_take(fb_system_work *w, const fb_system *system, const fb_body *body,
                            const fb_system_state *state, const fb_link_motion *motion, const fb_system_input *input)
{
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *L = &w->link[k];
    const fb_joint *joint = &system->joint[k];
    for (int i = 0; i < joint->n_axis; i++) {
      const fb_axis_mode mode = state->mode[k][joint->kind == FB_JOINT_FREE ? 0 : i];
      L->u[i] = mode == FB_AXIS_FREE && motion ? motion[k].speed[i] : FB_R(0.0);
      L->u[i] = mode == FB_AXIS_PRESCRIBED && input ? input->drive[k].rate[i] : L->u[i];
    }
    if (joint->kind == FB_JOINT_FREE && state->mode[k][0] != FB_AXIS_LOCKED) {
      fbi_own_frame_add(L->u, -FB_R(1.0), w, k);
    }
    for (int a = 0; a < fbi_model(system, body, k)->n; a++) {
      L->q_dot[a] = motion ? motion[k].q_dot[a] : FB_R(0.0);
    }
  }
  fbi_speeds_out(w, system, body);
}

/* Initial velocities of the tree frames: those of their free roots; trees that are tied share the first one's. */
static void fbi_frames_init(fb_system_state *state, const fb_system *system, const fb_link_motion *motion,
                            const fb_system_input *input)
{
  const fb_real *common = NULL;

  /* each free root */
  for (int k = 0; k < system->n_body; k++) {
    const fb_axis_mode mode = state->mode[k][0];
    fb_real R[9];
    if (system->joint[k].kind == FB_JOINT_FREE && system->tied < 2) {
      const fb_real *v = mode == FB_AXIS_FREE && motion        ? motion[k].speed
                         : mode == FB_AXIS_PRESCRIBED && input ? input->drive[k].rate
                                                               : NULL;
      fb_quat_to_mat33(R, state->link[k].quat);
      if (v) {
        fb_mat33_mul_vec3(state->link[k].u, R, v);
      }
      common = common ? common : state->link[k].u;
    }
  }

  /* tied trees */
  for (int k = 0; k < system->n_body && system->tied && common; k++) {
    if (state->link[k].u != common) {
      fbi_vec3_copy(state->link[k].u, common);
    }
  }
}

/* Poses and velocities of all bodies from the coordinates and speeds of the tree (no joint of it as constraint). */
static fb_status fbi_motion_place(fb_system_work *w, const fb_system *system, const fb_body *body,
                                  fb_system_state *state, const fb_link_motion *motion, const fb_system_input *input)
{
  w->kept = 0;

  /* coordinates */
  for (int k = 0; k < system->n_body; k++) {
    const fb_link_motion *m = motion ? &motion[k] : NULL;
    const fb_body *model = fbi_model(system, body, k);
    fb_link_state *x = &state->link[k];
    x->quat[0] = FB_R(1.0);
    if (!m) {
      continue;
    }
    if (!fbi_is_finite(m->value, 3) || !fbi_is_finite(m->quat, 4) || !fbi_is_finite(m->speed, 6) ||
        !fbi_is_finite(m->q, model->n) || !fbi_is_finite(m->q_dot, model->n)) {
      return FB_ERR_NOT_FINITE;
    }
    if (!fbi_is_attitude(m->quat)) {
      return FB_ERR_VALUE;
    }
    fbi_vec3_copy(x->x, m->value);
    fbi_copy(x->q, m->q, model->n);
    if (m->quat[0] != FB_R(0.0) || fbi_vec3_norm(m->quat + 1) > FB_R(0.0)) {
      fbi_copy(x->quat, m->quat, 4);
      (void)fb_quat_normalize(x->quat);
    }
  }

  /* frames, poses, speeds */
  fbi_frames_init(state, system, motion, input);
  fbi_prescribe(state, system, w, state, input);
  fbi_links_place(w, system, body, state, state);
  fbi_speeds_take(w, system, body, state, motion, input);
  return FB_OK;
}

/* With all joints as constraints the coordinates of each body are its pose. */
static void fbi_poses_to_state(fb_system_state *state, const fb_system_work *w, const fb_system *system)
{
  for (int k = 0; k < system->n_body; k++) {
    fb_link_state *x = &state->link[k];
    fbi_vec3_copy(x->x, w->link[w->link[k].root].origin);
    fbi_vec3_zero(x->lost_x);
    fbi_keep(x->x, x->lost_x, w->link[k].rho, 3);
    fbi_quat_from_mat33(x->quat, w->link[k].k.R);
  }
}

/* Stores the present value of an axis of joint j, enforced by multipliers, as that where it is locked. */
static fb_status fbi_hold_set(fb_system_state *state, fb_system_work *w, const fb_system *system, const fb_body *body,
                              int j, int axis)
{
  fbi_frames f;
  fb_real value[3];
  const fb_status status = fbi_frames_eval(&f, w, system, body, j);
  if (status != FB_OK) {
    return status;
  }
  fbi_frames_value(value, &f, &system->joint[j]);
  state->hold[j][axis] = value[axis];
  if (system->joint[j].kind == FB_JOINT_SPHERICAL) {
    fb_quat_from_rotvec(state->hold_quat[j], value);
  }
  return FB_OK;
}

/* The same for all axes of joints enforced by multipliers, from joint `first` on. */
static fb_status fbi_holds_set(fb_system_state *state, fb_system_work *w, const fb_system *system, const fb_body *body,
                               int first)
{
  fb_status status = FB_OK;
  for (int j = first; j < system->n_body + system->n_loop && status == FB_OK; j++) {
    for (int i = 0; i < system->joint[j].n_axis && i < 3 && fbi_is_kept(system, w, j) && status == FB_OK; i++) {
      status = fbi_hold_set(state, w, system, body, j, i);
    }
  }
  return status;
}

/* Is a joint assembled the right way round? Its perpendicularity constraints also hold when it is rotated by pi. */
static int fbi_is_upright(fb_system_work *w, const fb_system *system, const fb_body *body, int j)
{
  const fbi_joint_traits *is = fbi_traits(&system->joint[j]);
  fbi_frames f;
  if (fbi_is_ball(system->joint[j].kind) || is->tilt >= 0 || fbi_frames_eval(&f, w, system, body, j) != FB_OK) {
    return 1;
  }
  return fb_vec3_dot(f.a[2], f.b[2]) > FB_R(0.0) && (is->angle >= 0 || fb_vec3_dot(f.a[0], f.b[0]) > FB_R(0.0));
}

/* Newton steps of E9.17 from a rough guess; locked axes of loops are free meanwhile and locked where they end. */
static fb_status fbi_loops_close(fb_system_work *w, const fb_system *system, const fb_body *body,
                                 fb_system_state *state, const fb_system_input *input)
{
  fb_real miss = FB_R(1.0);
  fb_status status = FB_OK;
  int worst = -1;

  /* locked axes of loops are free during the iteration */
  fb_system_state *modes = &w->base;
  *modes = *state;
  for (int j = system->n_body; j < system->n_body + system->n_loop; j++) {
    for (int i = 0; i < 3; i++) {
      modes->mode[j][i] = state->mode[j][i] == FB_AXIS_LOCKED ? FB_AXIS_FREE : state->mode[j][i];
    }
  }

  /* Newton steps, at first with modes held by a large mass */
  for (int step = 0; step < 50 && status == FB_OK && !(miss <= FB_R(8.0) * FB_EPSILON); step++) {
    const int before = worst;
    w->heavy = step < 20 ? FB_R(1e6) : FB_R(0.0);
    status = fbi_positions_close(&miss, &worst, w, system, body, state, modes, input);
    if (step > 0 && (status == FB_ERR_UNDETERMINED || status == FB_ERR_RANGE)) { /* diverged */
      w->joint = before;
      status = FB_ERR_CONTRADICTION;
    }
  }

  /* converged, and on the right branch? */
  w->heavy = FB_R(0.0);
  if (status == FB_OK && !(miss <= (FB_SINGLE ? FB_R(1e-4) : FB_R(1e-10)))) {
    w->joint = worst;
    status = FB_ERR_CONTRADICTION;
  }
  for (int j = 0; j < system->n_body + system->n_loop && status == FB_OK; j++) {
    if (fbi_is_kept(system, w, j) && !fbi_is_upright(w, system, body, j)) {
      w->joint = j;
      status = FB_ERR_CONTRADICTION;
    }
  }
  return status == FB_OK ? fbi_holds_set(state, w, system, body, system->n_body) : status;
}

/* Closes the loops of a state that is being initialized: positions, where the mass centers stay, as they carry the
   momentum; then the velocities, projected to what the constraints allow. */
static fb_status fbi_motion_close(fb_system_state *out, fb_system_work *w, const fb_system *system, const fb_body *body,
                                  const fb_system_input *input)
{
  fb_status status;
  fbi_links_place(w, system, body, out, out);
  if (system->tied < 2) {
    fbi_frames_renew(out, w, system, input);
    fbi_links_place(w, system, body, out, out);
  }

  /* positions, mass centers back to where they were */
  fbi_flight_begin(w, system);
  status = fbi_loops_close(w, system, body, out, input);
  if (status != FB_OK) {
    return status;
  }
  fbi_trees_sum(w, system, out, NULL);
  fbi_trees_hold(w, system, out);
  fbi_links_place(w, system, body, out, out);
  fbi_trees_weigh(w, system, 0);
  fbi_centers_lead(out, w, system);

  /* velocities */
  return fbi_momenta_close(w, system, body, out, out, input);
}

FB_DEF fb_status fb_system_state_init(const fb_system *system, const fb_body *body, fb_system_state *state,
                                      fb_system_work *work, const fb_link_motion *motion, const fb_system_input *input)
{
  fb_system_state *out;
  fb_status status;
  FBI_REQUIRE(system && body && work && state, FB_ERR_NULL);
  FBI_REQUIRE_EXACT();

  /* axis modes */
  status = fbi_system_input_check(system, body, input);
  fbi_system_enter(work, system);
  out = &work->stage;
  memset(out, 0, sizeof *out);
  for (int j = 0; j < system->n_body + system->n_loop; j++) {
    for (int i = 0; i < 3; i++) {
      out->mode[j][i] = system->joint[j].mode[i];
    }
  }

  /* poses, velocities and momenta of the tree; with multipliers, of free bodies */
  status = status == FB_OK ? fbi_motion_place(work, system, body, out, motion, input) : status;
  if (status != FB_OK) {
    return status;
  }
  work->kept = system->method == FB_METHOD_MULTIPLIERS;
  if (work->kept) {
    fbi_poses_to_state(out, work, system);
  }
  status = fbi_holds_set(out, work, system, body, 0);
  fbi_momenta_fill(out, work, system, body);

  /* constraints; frames of free trees */
  if (status == FB_OK && fbi_has_rows(system, work, input)) {
    status = fbi_motion_close(out, work, system, body, input);
  }
  if (status == FB_OK && fbi_flies(system, work)) {
    fbi_frames_renew(out, work, system, input);
  }

  /* range check; result */
  status = status == FB_OK ? fbi_system_range(system, body, out) : status;
  if (status == FB_OK) {
    *state = *out;
  }
  return status;
}

FB_DEF fb_status fb_system_axis_set(const fb_system *system, const fb_body *body, fb_system_state *state,
                                    fb_system_work *work, int joint, int axis, fb_axis_mode mode,
                                    const fb_system_input *input)
{
  fb_system_state *out;
  fb_status status;
  FBI_REQUIRE(system && body && work && state, FB_ERR_NULL);
  FBI_REQUIRE(joint >= 0 && joint < system->n_body + system->n_loop && axis >= 0, FB_ERR_CAPACITY);
  FBI_REQUIRE(axis < system->joint[joint].n_axis && axis < 3, FB_ERR_CAPACITY);
  FBI_REQUIRE(fbi_is_choice((int)mode, (int)FB_AXIS_COUNT - 1), FB_ERR_VALUE);
  status = fbi_system_input_check(system, body, input);
  if (status != FB_OK) {
    return status;
  }

  /* momenta and position of the axis as it is now */
  fbi_system_enter(work, system);
  out = &work->stage;
  *out = *state;
  status = fbi_momenta_close(work, system, body, out, out, input); /* momenta of locked and prescribed axes */
  if (status == FB_OK && fbi_is_kept(system, work, joint)) {
    status = fbi_hold_set(out, work, system, body, joint, axis);
  }

  /* new mode; free and spherical joints have one for all axes */
  for (int i = 0; i < 3; i++) {
    const int all = fbi_is_ball(system->joint[joint].kind);
    if (all || i == axis) {
      out->mode[joint][i] = mode;
    }
  }

  /* frames, momenta in the new mode */
  if (status == FB_OK && system->joint[joint].kind == FB_JOINT_FREE) {
    fbi_frames_renew(out, work, system, input);
  }
  status = status == FB_OK ? fbi_momenta_close(work, system, body, out, out, input) : status;
  if (status == FB_OK) {
    *state = *out;
  }
  return status;
}

FB_DEF fb_status fb_system_rates_eval(const fb_system *system, const fb_body *body, fb_system_work *work,
                                      fb_system_state *rate, const fb_system_state *state, const fb_system_input *input)
{
  fb_system_state *out;
  fb_status status;
  FBI_REQUIRE(system && body && work && rate && state, FB_ERR_NULL);
  out = &work->rate;
  memset(out, 0, sizeof *out);

  /* rates in the frames of the trees */
  status = fbi_system_input_check(system, body, input);
  fbi_system_enter(work, system);
  status = status == FB_OK ? fbi_system_rates(work, system, body, out, state, state, input) : status;

  /* free roots: velocity from the ground */
  for (int k = 0; k < system->n_body && status == FB_OK; k++) {
    fb_link_state *x = &out->link[k];
    if (fbi_link_joint(system, work, k)->kind == FB_JOINT_FREE) {
      fbi_vec3_copy(x->x, x->lost_x);
      fbi_vec3_add(x->x, FB_R(1.0), work->link[work->link[k].root].frame);
      fbi_vec3_zero(x->lost_x);
    }
    status = fbi_link_state_is_finite(x, fbi_model(system, body, k)->n) ? FB_OK : FB_ERR_NOT_FINITE;
  }
  if (status == FB_OK) {
    *rate = *out;
  }
  return status;
}

/* ---- accelerations */

/* Rates of a body's own momenta at the accelerations V_dot, q_ddot: G_dot to L->b, pi_dot to L->e. */
static void fbi_own_momentum_rates(fbi_link_work *L, const fb_body *body, const fb_real V_dot[6], const fb_real *q_ddot)
{
  const int n = body->n;
  fb_real xd[FB_MAX_MODES + 1], e[FB_MAX_MODES], pb_dot[FB_MAX_MODES], unused[FB_MAX_MODES + 1] = {0};
  fb_real SV[6], elastic[6] = {0};

  /* pi_dot = d/dt (M q_dot + Lambda^T V) */
  xd[0] = FB_R(0.0);
  fbi_copy(xd + 1, L->q_dot, n);
  fbi_zero(e, n);
  fbi_lambda_gradients(e, unused, body, V_dot, L->k.qx, L->k.pb);
  fbi_lambda_linear_gradients(e, unused, body, L->V, xd, L->k.pb);
  fbi_mass_mul(L->e, body, q_ddot);
  fbi_row_sub(L->e, FB_R(1.0), e, n);
  fbi_mass_solve(pb_dot, body, L->e);

  /* G_dot = d/dt (S V + Lambda pb) */
  fbi_S_rate(L->k.dS, body, L->k.qx, xd);
  fb_sym6_mul_vec6(L->b, L->k.S, V_dot);
  fb_sym6_mul_vec6(SV, L->k.dS, L->V);
  fbi_lambda_sub(elastic, body, L->k.qx, pb_dot);
  fbi_lambda_linear_sub(elastic, body, xd, L->k.pb);
  for (int i = 0; i < 6; i++) {
    L->b[i] += SV[i] - elastic[i];
  }
}

/* y += V x T, the rate of a twist T transported by V. */
static void fbi_twist_cross_add(fb_real y[6], const fb_real V[6], const fb_real T[6])
{
  fbi_vec3_add_cross(y, V + 3, T);
  fbi_vec3_add_cross(y, V, T + 3);
  fbi_vec3_add_cross(y + 3, V + 3, T + 3);
}

/* [E9.18] Bias acceleration: V_dot of a body at zero accelerations of its joint (prescribed ones as given) and of its
   parent's modes. With the node's twist T = (u_dot + n x phi_rate, phi_rate) about the parent's origin,
   V_dot = X (V_p_dot + T_dot + V_p x T) + A u_dot + A_dot u + V x A u.
   Source: rates of twists; [FE] 5.  Test: accelerations_are_the_rates_of_velocities. */
static void fbi_bias_acceleration(fbi_link_work *L, const fb_joint *joint, const fbi_link_work *parent,
                                  const fb_body *on, const fb_real *given)
{
  fb_real turn[6] = {0}, own[6] = {0};
  fbi_vec6_zero(L->V_dot);
  if (joint->kind == FB_JOINT_FREE) {
    fbi_vec6_copy(L->V_dot, given);
    return;
  }

  /* X (V_p_dot + T_dot + V_p x T) */
  if (parent) {
    fb_real a[6], v[3];
    fbi_vec6_copy(a, parent->V_dot);
    if (joint->moves) {
      fb_real T[6], u_dd[3], turn_dd[3];
      fbi_vec3_sum(T, L->node.Ju, parent->q_dot, on->n);
      fbi_vec3_sum(T + 3, L->node.Jphi, parent->q_dot, on->n);
      fbi_node_convection(u_dd, turn_dd, &L->node, on, &on->node[joint->parent_node], parent->q_dot);
      fbi_vec3_add(a, FB_R(1.0), u_dd);
      fbi_vec3_add(a + 3, FB_R(1.0), turn_dd);
      fbi_vec3_add_cross(a, T, T + 3);
      fbi_vec3_add_cross(a, L->n, turn_dd);
      fbi_vec3_add_cross(T, L->n, T + 3);
      fbi_twist_cross_add(a, parent->V, T);
    }

    /* X: to the child's origin and axes */
    fbi_vec3_copy(v, a);
    fbi_vec3_add_cross(v, a + 3, L->s);
    fb_mat33_mulT_vec3(L->V_dot, L->C, v);
    fb_mat33_mulT_vec3(L->V_dot + 3, L->C, a + 3);
  }

  /* A u_dot + A_dot u + V x A u */
  for (int i = 0; i < joint->n_axis; i++) {
    fbi_vec6_add(own, L->u[i], L->A + 6 * i);
    fbi_vec6_add(L->V_dot, given[i], L->A + 6 * i);
  }
  if (joint->kind == FB_JOINT_UNIVERSAL) {
    fbi_vec6_add(L->V_dot, L->u[0] * L->u[1], L->A_dot);
  }
  fbi_twist_cross_add(turn, L->V, own);
  fbi_vec6_add(L->V_dot, FB_R(1.0), turn);
}

/* Acceleration of an end at V_dot of its body and q_ddot = 0, as E8.20. */
static void fbi_end_acceleration(fbi_end *end, const fb_system_work *w, const fb_system *system, const fb_body *body)
{
  if (end->link >= 0) { /* the ground's are zero from the start */
    const fbi_link_work *L = &w->link[end->link];
    const fb_body *model = fbi_model(system, body, end->link);
    fb_real a[3], alpha[3], ud[3], pd[3], u_dd[3], turn_dd[3], inner[3];
    fbi_vec3_sum(ud, end->f.Ju, L->q_dot, model->n);
    fbi_vec3_sum(pd, end->f.Jphi, L->q_dot, model->n);
    fbi_node_convection(u_dd, turn_dd, &end->f, model, &model->node[end->node], L->q_dot);

    /* a = v_dot + u_dd + w_dot x n + w x (w x n + 2 u_dot + v), alpha = w_dot + phi_dd + w x phi_dot */
    fb_vec3_cross(inner, L->V + 3, end->n);
    for (int i = 0; i < 3; i++) {
      a[i] = L->V_dot[i] + u_dd[i];
      alpha[i] = L->V_dot[3 + i] + turn_dd[i];
      inner[i] += FB_R(2.0) * ud[i] + L->V[i];
    }
    fbi_vec3_add_cross(a, L->V_dot + 3, end->n);
    fbi_vec3_add_cross(a, L->V + 3, inner);
    fbi_vec3_add_cross(alpha, L->V + 3, pd);
    fb_mat33_mul_vec3(end->a, L->k.R, a);
    fb_mat33_mul_vec3(end->alpha, L->k.R, alpha);
  }
}

/* Residual of a body's equations of motion, to be balanced by its joints: y = F - turning of G - G_dot; pi_dot to
   L->e. */
static void fbi_own_residual(fbi_link_work *L, const fb_body *body, const fb_real V_dot[6], const fb_real *q_ddot)
{
  fb_real turn[6];
  fbi_own_momentum_rates(L, body, V_dot, q_ddot);
  fbi_turning(turn, L->V, L->k.ph);
  for (int i = 0; i < 6; i++) {
    L->y[i] = L->k.fg[i] - turn[i] - L->b[i];
  }
}

/* L->given: accelerations of prescribed axes, of a free joint less d/dt of R^T u, the velocity of the tree's frame. */
static void fbi_given_accelerations(fb_system_work *w, const fb_joint *joint, const fb_system_input *input, int k)
{
  fbi_link_work *L = &w->link[k];
  fbi_vec6_zero(L->given);
  for (int i = 0; i < joint->n_axis; i++) {
    const fb_axis_mode mode = fbi_axis_mode(L, joint, i);
    L->given[i] = mode == FB_AXIS_PRESCRIBED && input ? input->drive[k].acceleration[i] : FB_R(0.0);
  }
  if (joint->kind == FB_JOINT_FREE && L->mode[0] == FB_AXIS_PRESCRIBED) {
    fb_real u[3] = {0};
    fbi_own_frame_add(u, FB_R(1.0), w, k);
    fbi_vec3_add_cross(L->given, L->V + 3, u);
  }
}

/* Coordinates of the axes of a joint of the tree, of a spherical one its rotation vector. */
static void fbi_axis_values(fb_real value[3], const fb_joint *joint, const fb_link_state *x)
{
  fbi_vec3_copy(value, x->x);
  if (joint->kind == FB_JOINT_SPHERICAL) {
    fb_quat_to_rotvec(value, x->quat);
  }
}

/* p = tau, the efforts of spring, damper and motor (E9.11) on the free axes of a joint; zero on the others. */
static void fbi_free_efforts(fbi_link_work *L, const fb_joint *joint, const fb_link_state *x,
                             const fb_system_input *input, int k)
{
  fb_real value[3];
  fbi_vec6_zero(L->p);
  if (joint->kind == FB_JOINT_FREE) {
    return;
  }
  fbi_axis_values(value, joint, x);
  for (int i = 0; i < joint->n_axis; i++) {
    if (L->mode[i] == FB_AXIS_FREE) {
      L->p[i] = fbi_axis_torque(joint, input, k, i, value[i], L->u[i]);
    }
  }
}

/* Right-hand side of E9.19 in body k: bias acceleration, the residuals there of body and modes, y = F - turning - G_dot
   and pi = f - pi_dot, and the efforts of its joint. */
static void fbi_acceleration_rhs(fb_system_work *w, const fb_system *system, const fb_body *body,
                                 const fb_link_state *x, const fb_system_input *input, int k)
{
  const fb_real still[FB_MAX_MODES] = {0};
  fbi_link_work *L = &w->link[k];
  const fb_body *model = fbi_model(system, body, k);
  const fb_joint *joint = fbi_link_joint(system, w, k);
  const fbi_link_work *parent = fbi_parent(w, joint);
  fbi_given_accelerations(w, joint, input, k);
  fbi_bias_acceleration(L, joint, parent, parent ? fbi_model(system, body, joint->parent) : NULL, L->given);
  fbi_elastic_forces(L->pi, &L->k, model, x->q, L->q_dot);
  fbi_own_residual(L, model, L->V_dot, still);
  fbi_row_sub(L->pi, FB_R(1.0), L->e, model->n);
  fbi_free_efforts(L, joint, x, input, k);
}

/* c = b_dot + A_dot u + A a of the rows, a: accelerations of their ends at the bias accelerations of the bodies. */
static void fbi_rows_accelerate(fb_system_work *w, const fb_system *system, const fb_body *body)
{
  for (int e = 0; e < w->n_end; e++) {
    fbi_end_acceleration(&w->end[e], w, system, body);
  }
  for (int r = 0; r < w->n_row; r++) {
    const fbi_row *row = &w->row[r];
    fb_real size;
    w->c[r] = row->b_dot + fbi_row_drift(&size, w, row, (const fb_real(*)[3])row->force_dot);
    for (int s = 0; s < 2; s++) {
      const fbi_end *end = &w->end[row->end[s]];
      w->c[r] += fb_vec3_dot(row->r.force[s], end->a) + fb_vec3_dot(row->r.torque[s], end->alpha) +
                 fb_vec3_dot(row->force_dot[s], end->v) + fb_vec3_dot(row->torque_dot[s], end->w);
    }
  }
}

/* [E9.19] Accelerations: the residuals of the bodies with joints and modes at constant speed, solved with the factors
   of the momenta, M u_dot = tau + sum of X^T (F - turning - G_dot); G of the solution are the joint forces.
   Source: Newton-Euler; THEORY.md 8.5, acceleration form.  Fails: as the rates.
   Test: accelerations_are_the_rates_of_velocities, joint_forces_carry_what_hangs_on_them. */
static fb_status fbi_system_accelerations(fb_system_work *w, const fb_system *system, const fb_body *body,
                                          const fb_system_state *state, const fb_system_input *input)
{
  /* forces on the bodies, then the efforts of joints enforced by multipliers */
  fbi_system_loads(w, system, body, input);
  for (int k = 0; k < system->n_body; k++) {
    fbi_vec6_copy(w->link[k].F, w->link[k].k.fg); /* without the joints */
  }
  (void)fbi_kept_springs(w, system, body, state, input);

  /* right-hand side of the bodies, then of the rows */
  for (int k = 0; k < system->n_body; k++) {
    fbi_acceleration_rhs(w, system, body, &state->link[k], input, k);
  }
  fbi_rows_accelerate(w, system, body);

  /* solution, in the place of the velocities, which are kept */
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *L = &w->link[k];
    fbi_vec6_copy(L->twist, L->V);
    fbi_vec6_copy(L->speed, L->u);
    fbi_copy(L->q_speed, L->q_dot, fbi_model(system, body, k)->n);
  }
  return w->n_row > 0 ? fbi_constrained_solve(w, system, body, 0) : fbi_speeds_solve(w, system, body);
}

/* Reaction force and torque, coordinates, speeds, accelerations and efforts of a joint of the tree. */
static void fbi_tree_joint_motion(fb_joint_motion *out, const fbi_link_work *L, const fb_joint *joint,
                                  const fb_link_state *x)
{
  fb_real torque[3], moment[3];

  /* reaction, torque about the joint frame, inertial axes */
  fb_vec3_cross(moment, joint->child_position, L->G);
  for (int i = 0; i < 3; i++) {
    torque[i] = L->G[3 + i] - moment[i];
  }
  fb_mat33_mul_vec3(out->force, L->k.R, L->G);
  fb_mat33_mul_vec3(out->torque, L->k.R, torque);

  /* coordinates */
  fbi_copy(out->value, x->x, joint->n_axis < 3 ? joint->n_axis : 3);
  if (joint->kind == FB_JOINT_SPHERICAL) {
    fb_quat_to_rotvec(out->value, x->quat);
  }

  /* speeds, accelerations, efforts */
  for (int i = 0; i < joint->n_axis; i++) {
    out->speed[i] = L->speed[i];
    out->acceleration[i] = L->given[i] + L->u[i];
    if (joint->kind != FB_JOINT_FREE) {
      out->drive[i] = fbi_vec6_dot(L->A + 6 * i, L->G);
    }
  }
}

/* The same for a joint enforced by multipliers, from its rows, springs and motors; without accelerations. */
static void fbi_kept_joint_motion(fb_joint_motion *out, fb_system_work *w, const fb_system *system, const fb_body *body,
                                  const fb_system_state *state, const fb_system_input *input, int j)
{
  const fb_joint *joint = &system->joint[j];
  fbi_frames f;

  /* coordinates */
  (void)fbi_frames_eval(&f, w, system, body, j);
  fbi_frames_value(out->value, &f, joint);

  /* forces of its rows */
  for (int r = 0; r < w->n_joint_row; r++) {
    const fbi_row *row = &w->row[r];
    if (row->joint == j) {
      fb_real moment[3];
      fb_vec3_cross(moment, f.arm[1], row->r.force[1]);
      fbi_vec3_add(out->force, w->mu[r], row->r.force[1]);
      fbi_vec3_add(out->torque, w->mu[r], row->r.torque[1]);
      fbi_vec3_add(out->torque, -w->mu[r], moment);
    }
  }

  /* speeds; efforts of springs, dampers and motors */
  for (int i = 0; i < joint->n_axis; i++) {
    fb_real force[3], torque[3];
    fbi_frames_axis(force, torque, &f, joint, i);
    out->speed[i] = fbi_frames_speed(&f, w, force, torque);
    if (state->mode[j][i] == FB_AXIS_FREE) {
      const fb_real tau = fbi_axis_torque(joint, input, j, i, out->value[i], out->speed[i]);
      fbi_vec3_add(out->force, tau, force);
      fbi_vec3_add(out->torque, tau, torque);
    }
    out->drive[i] = fb_vec3_dot(force, out->force) + fb_vec3_dot(torque, out->torque);
    if (fbi_traits(joint)->pitched) {
      out->drive[i] += joint->pitch * fb_vec3_dot(f.a[2], out->force);
    }
  }
}

/* Power of the motors of a joint and of what prescribes its axes, without springs and dampers. */
static fb_real fbi_joint_power(const fb_system_work *w, const fb_joint_motion *at, const fb_joint *joint,
                               const fb_system_state *state, const fb_system_input *input, int j)
{
  fb_real power = FB_R(0.0);
  if (joint->kind == FB_JOINT_FREE) {
    fb_real v[6];
    fbi_vec6_copy(v, w->link[j].twist);
    fbi_own_frame_add(v, FB_R(1.0), w, j);
    return state->mode[j][0] == FB_AXIS_PRESCRIBED ? fbi_vec6_dot(w->link[j].G, v) : power;
  }
  for (int i = 0; i < joint->n_axis; i++) {
    const fb_real motor = input ? input->drive[j].torque[i] : FB_R(0.0);
    const fb_real drive = at->drive[i] - fbi_axis_torque(joint, NULL, j, i, at->value[i], at->speed[i]);
    power += at->speed[i] * (state->mode[j][i] == FB_AXIS_FREE ? motor : drive);
  }
  return power;
}

/* Pose and motion of a body, and the reaction of its joint if that is of the tree; V and q_dot become velocities
   again. */
static void fbi_link_motion(fb_system_motion *motion, fb_system_work *w, const fb_system *system, const fb_body *body,
                            const fb_system_state *state, int k)
{
  const fb_body *model = fbi_model(system, body, k);
  fbi_link_work *L = &w->link[k];
  fb_state *pose = &motion->pose[k];
  fb_motion *out = &motion->motion[k];
  fb_real u[3] = {0}, turn[3];

  /* pose */
  for (int i = 0; i < 3; i++) {
    pose->rho[i] = fbi_true_position(w, k, L->rho, i);
  }
  fbi_quat_from_mat33(pose->quat, L->k.R);
  fbi_copy(pose->q, L->k.qx + 1, model->n);

  /* joint of the tree */
  if (!fbi_is_kept(system, w, k)) {
    fbi_tree_joint_motion(&motion->joint[k], L, fbi_link_joint(system, w, k), &state->link[k]);
  }

  /* velocities and accelerations */
  fbi_vec6_add(L->V_dot, FB_R(1.0), L->V);
  fbi_vec6_copy(L->V, L->twist);
  fbi_vec3_copy(out->v, L->V);
  fbi_vec3_copy(out->w, L->V + 3);
  fb_vec3_cross(out->acceleration, L->V + 3, L->V); /* the tree's frame does not accelerate */
  fbi_vec3_add(out->acceleration, FB_R(1.0), L->V_dot);
  fbi_vec3_copy(out->w_dot, L->V_dot + 3);
  fbi_copy(out->q_ddot, L->q_dot, model->n);
  fbi_copy(L->q_dot, L->q_speed, model->n);
  fbi_copy(out->q_dot, L->q_dot, model->n);

  /* reaction on the body */
  fbi_vec6_copy(L->k.fg, L->F);
  fbi_own_residual(L, model, L->V_dot, out->q_ddot);

  /* velocities from the ground; R^T u rotates in body axes */
  fbi_own_frame_add(u, FB_R(1.0), w, k); /* v + R^T u */
  fb_vec3_cross(turn, L->V + 3, u);
  for (int i = 0; i < 3; i++) {
    out->reaction_force[i] = -L->y[i];
    out->reaction_torque[i] = -L->y[3 + i];
    out->v[i] += u[i];
    if (fbi_link_joint(system, w, k)->kind == FB_JOINT_FREE && !fbi_is_kept(system, w, k)) {
      motion->joint[k].speed[i] += u[i];
      motion->joint[k].acceleration[i] -= turn[i];
    }
  }
}

FB_DEF fb_status fb_system_motion_eval(const fb_system *system, const fb_body *body, fb_system_work *work,
                                       fb_system_motion *motion, const fb_system_state *state,
                                       const fb_system_input *input)
{
  fb_status status;
  FBI_REQUIRE(system && body && work && motion && state, FB_ERR_NULL);

  /* velocities and momenta */
  status = fbi_system_input_check(system, body, input);
  fbi_system_enter(work, system);
  status = status == FB_OK ? fbi_system_velocity(work, system, body, state, state, input, 0) : status;
  for (int k = 0; k < system->n_body && status == FB_OK; k++) {
    fbi_link_kinetics(&work->link[k], fbi_model(system, body, k));
    fbi_momenta(&work->link[k].k, fbi_model(system, body, k));
  }

  /* accelerations; all finite? */
  status = status == FB_OK ? fbi_system_accelerations(work, system, body, state, input) : status;
  for (int k = 0; k < system->n_body && status == FB_OK; k++) {
    const fbi_link_work *L = &work->link[k];
    const int n = fbi_model(system, body, k)->n;
    status = fbi_is_finite(L->V, 6) && fbi_is_finite(L->G, 6) && fbi_is_finite(L->q_dot, n) ? FB_OK : FB_ERR_NOT_FINITE;
  }
  if (status != FB_OK) {
    return status;
  }

  /* bodies */
  memset(motion, 0, sizeof *motion);
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_motion(motion, work, system, body, state, k);
  }

  /* joints enforced by multipliers; power of all */
  for (int j = 0; j < system->n_body + system->n_loop; j++) {
    fb_joint_motion *at = &motion->joint[j];
    const fb_joint *joint = &system->joint[j];
    if (fbi_is_kept(system, work, j)) {
      fbi_kept_joint_motion(at, work, system, body, state, input, j);
    }
    motion->power += fbi_joint_power(work, at, joint, state, input, j);
  }
  return FB_OK;
}

/* Adds the energy of body k: kinetic in the tree's frame, (V.(p, h) + q_dot.M pb)/2, and by the velocity u of that
   frame, p.u + m u.u/2; potentials. */
static void fbi_link_energy_add(fb_energy *out, fb_system_work *w, const fb_body *model, const fb_real *q, int k)
{
  fbi_link_work *L = &w->link[k];
  fb_real u[3] = {0}, rho[3];
  fbi_link_kinetics(L, model);
  fbi_momenta(&L->k, model);
  fbi_mass_mul(L->e, model, L->k.pb);
  out->kinetic += FB_R(0.5) * (fbi_vec6_dot(L->k.ph, L->V) + fbi_dot(L->e, L->q_dot, model->n));
  fbi_own_frame_add(u, FB_R(1.0), w, k);
  out->kinetic += fb_vec3_dot(L->k.ph, u) + FB_R(0.5) * model->mass * fb_vec3_dot(u, u);
  for (int i = 0; i < 3; i++) {
    rho[i] = fbi_true_position(w, k, L->rho, i);
  }
  fbi_potential_add(out, &L->k, model, q, rho);
}

/* Strain energy of the springs of joint j, sum of k (x - rest)^2/2. */
static void fbi_spring_energy_add(fb_energy *out, fb_system_work *w, const fb_system *system, const fb_body *body,
                                  const fb_system_state *state, int j)
{
  const fb_joint *joint = &system->joint[j];
  fb_real value[3];
  if (fbi_is_kept(system, w, j)) {
    fbi_frames f;
    (void)fbi_frames_eval(&f, w, system, body, j);
    fbi_frames_value(value, &f, joint);
  } else {
    fbi_axis_values(value, joint, &state->link[j]);
  }
  for (int i = 0; i < joint->n_axis && i < 3; i++) {
    const fb_real stretch = value[i] - joint->rest[i];
    out->strain += FB_R(0.5) * joint->stiffness[i] * stretch * stretch;
  }
}

FB_DEF fb_status fb_system_energy_eval(const fb_system *system, const fb_body *body, fb_system_work *work,
                                       fb_energy *energy, const fb_system_state *state, const fb_system_input *input)
{
  fb_energy out = {FB_R(0.0), FB_R(0.0), FB_R(0.0)};
  fb_status status;
  FBI_REQUIRE(system && body && work && energy && state, FB_ERR_NULL);

  /* velocities */
  status = fbi_system_input_check(system, body, input);
  fbi_system_enter(work, system);
  status = status == FB_OK ? fbi_system_velocity(work, system, body, state, state, input, 0) : status;
  if (status != FB_OK) {
    return status;
  }

  /* bodies, springs of joints */
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_energy_add(&out, work, fbi_model(system, body, k), state->link[k].q, k);
  }
  for (int j = 0; j < system->n_body + system->n_loop; j++) {
    if (fbi_is_sprung(&system->joint[j], NULL, j)) {
      fbi_spring_energy_add(&out, work, system, body, state, j);
    }
  }
  if (!fbi_energy_is_finite(&out)) {
    return FB_ERR_NOT_FINITE;
  }
  *energy = out;
  return FB_OK;
}

/* Sums over the bodies, about the origin of the ground. */
FB_DEF fb_status fb_system_momentum_eval(const fb_system *system, const fb_body *body, fb_system_work *work,
                                         fb_momentum *momentum, const fb_system_state *state,
                                         const fb_system_input *input)
{
  fb_momentum out;
  fb_status status;
  FBI_REQUIRE(system && body && work && momentum && state, FB_ERR_NULL);

  /* velocities */
  status = fbi_system_input_check(system, body, input);
  fbi_system_enter(work, system);
  status = status == FB_OK ? fbi_system_velocity(work, system, body, state, state, input, 0) : status;
  if (status != FB_OK) {
    return status;
  }
  memset(&out, 0, sizeof out);

  /* own momentum, and that by the velocity of the tree's frame */
  for (int k = 0; k < system->n_body; k++) {
    const fb_body *model = fbi_model(system, body, k);
    fbi_link_work *L = &work->link[k];
    fb_real P[3], h[3], u[3] = {0}, rho[3];
    fbi_link_kinetics(L, model);
    fbi_momenta(&L->k, model);
    fbi_own_frame_add(u, FB_R(1.0), work, k);
    fbi_drift_momenta(L->b, L->e, L->first, L, model, u);
    fbi_vec6_add(L->k.ph, FB_R(1.0), L->b);
    fb_mat33_mul_vec3(P, L->k.R, L->k.ph);
    fb_mat33_mul_vec3(h, L->k.R, L->k.ph + 3);
    for (int i = 0; i < 3; i++) {
      rho[i] = fbi_true_position(work, k, L->rho, i);
    }
    fbi_vec3_add(out.linear, FB_R(1.0), P);
    fbi_vec3_add(out.angular, FB_R(1.0), h);
    fbi_vec3_add_cross(out.angular, rho, P);
  }
  if (!fbi_is_finite(out.linear, 3) || !fbi_is_finite(out.angular, 3)) {
    return FB_ERR_NOT_FINITE;
  }
  *momentum = out;
  return FB_OK;
}

/* ---- checks of what is in memory */

static int fbi_joint_is_sound(const fb_system *system, const fb_body *body, int j)
{
  const fb_joint *joint = &system->joint[j];
  const int loop = j >= system->n_body, most = loop ? system->n_body : j;
  int sound = fbi_is_choice((int)joint->kind, (int)FB_JOINT_COUNT - 1) && joint->parent >= FB_GROUND &&
              joint->parent < most && fbi_is_within(joint->child, system->n_body - 1) && (loop || joint->child == j) &&
              joint->parent_node >= 0 && joint->child_node >= 0 && fbi_is_flag(joint->moves) &&
              fbi_is_flag(joint->turned);

  /* axes and nodes */
  sound = sound && joint->n_axis == fbi_traits(joint)->n_axis &&
          (joint->parent < 0 ? joint->parent_node == 0 && !joint->moves
                             : joint->parent_node < fbi_model(system, body, joint->parent)->n_node) &&
          joint->child_node < fbi_model(system, body, joint->child)->n_node;

  /* values */
  sound = sound && fbi_is_finite(joint->position, 3) && fbi_is_finite(joint->axes, 9) &&
          fbi_is_finite(joint->child_position, 3) && fbi_is_finite(joint->child_axes, 9) &&
          fbi_is_finite(joint->A, 18) && fbi_is_finite(&joint->pitch, 1) && fbi_is_finite(joint->stiffness, 3) &&
          fbi_is_finite(joint->rest, 3) && fbi_is_finite(joint->damping, 3);
  for (int i = 0; sound && i < 3; i++) {
    sound = fbi_is_choice((int)joint->mode[i], (int)FB_AXIS_COUNT - 1) && joint->stiffness[i] >= FB_R(0.0) &&
            joint->damping[i] >= FB_R(0.0);
  }
  return sound;
}

FB_DEF fb_status fb_system_check(const fb_system *system, const fb_body *body, int n_model)
{
  int sound;
  FBI_REQUIRE(system && body, FB_ERR_NULL);
  if (n_model < 1 || system->n_body < 1 || system->n_body > FB_MAX_BODIES ||
      !fbi_is_within(system->n_loop, FB_MAX_LOOPS)) {
    return FB_ERR_CAPACITY;
  }
  {
    const fb_real limit[4] = {system->limit_elastic, system->limit_damping, system->limit_kept_elastic,
                              system->limit_kept_damping};
    sound = fbi_is_choice((int)system->method, (int)FB_METHOD_COUNT - 1) && fbi_is_flag(system->allow_long_step) &&
            fbi_is_within(system->tied, 2) && fbi_is_finite(limit, 4) && system->free.kind == FB_JOINT_FREE &&
            system->free.n_axis == 6 && system->free.parent == FB_GROUND;
  }

  /* models and joints */
  for (int k = 0; sound && k < system->n_body; k++) {
    sound = fbi_is_within(system->model[k], n_model - 1) && fbi_is_flag(system->coupled[k]) &&
            fb_body_check(fbi_model(system, body, k)) == FB_OK;
  }
  for (int j = 0; sound && j < system->n_body + system->n_loop; j++) {
    sound = fbi_joint_is_sound(system, body, j);
  }
  return sound ? FB_OK : FB_ERR_VALUE;
}

/* CRC of a joint (E8.40). */
static unsigned fbi_crc_joint(unsigned crc, const fb_joint *joint)
{
  const int whole[] = {(int)joint->kind,    joint->parent,       joint->parent_node, joint->child,
                       joint->child_node,   joint->n_axis,       joint->moves,       joint->turned,
                       (int)joint->mode[0], (int)joint->mode[1], (int)joint->mode[2]};
  crc = fbi_crc_ints(crc, whole, (int)(sizeof whole / sizeof *whole));
  crc = fbi_crc_reals(fbi_crc_reals(crc, joint->position, 3, FB_SINGLE), joint->axes, 9, FB_SINGLE);
  crc = fbi_crc_reals(fbi_crc_reals(crc, joint->child_position, 3, FB_SINGLE), joint->child_axes, 9, FB_SINGLE);
  crc = fbi_crc_reals(fbi_crc_reals(crc, joint->A, 18, FB_SINGLE), &joint->pitch, 1, FB_SINGLE);
  crc = fbi_crc_reals(fbi_crc_reals(crc, joint->stiffness, 3, FB_SINGLE), joint->rest, 3, FB_SINGLE);
  return fbi_crc_reals(crc, joint->damping, 3, FB_SINGLE);
}

FB_DEF unsigned fb_system_crc(const fb_system *system, const fb_body *body, int n_model)
{
  unsigned crc;
  FBI_REQUIRE(system && body, 0);
  if (n_model < 1 || !fbi_is_within(system->n_body, FB_MAX_BODIES) || !fbi_is_within(system->n_loop, FB_MAX_LOOPS)) {
    return 0;
  }

  /* options and limits */
  {
    const int whole[5] = {system->n_body, system->n_loop, (int)system->method, system->allow_long_step, system->tied};
    const fb_real limit[4] = {system->limit_elastic, system->limit_damping, system->limit_kept_elastic,
                              system->limit_kept_damping};
    crc = fbi_crc_reals(fbi_crc_ints(0xFFFFFFFFu, whole, 5), limit, 4, FB_SINGLE);
  }

  /* models */
  crc = fbi_crc_ints(fbi_crc_ints(crc, system->model, system->n_body), system->coupled, system->n_body);
  for (int k = 0; k < system->n_body; k++) {
    unsigned word = 0;
    if (fbi_is_within(system->model[k], n_model - 1)) {
      word = fb_body_crc(fbi_model(system, body, k));
    }
    if (word == 0) {
      return 0;
    }
    crc = fbi_crc_word(crc, word);
  }

  /* joints */
  for (int j = 0; j < system->n_body + system->n_loop; j++) {
    crc = fbi_crc_joint(crc, &system->joint[j]);
  }
  return ~fbi_crc_joint(crc, &system->free);
}

FB_DEF fb_status fb_system_state_check(const fb_system *system, const fb_body *body, const fb_system_state *state)
{
  fb_status status;
  FBI_REQUIRE(system && body && state, FB_ERR_NULL);

  /* each joint: axis modes, quaternions */
  status = fbi_system_range(system, body, state);
  for (int j = 0; status == FB_OK && j < system->n_body + system->n_loop; j++) {
    fb_real quat[4] = {FB_R(1.0)};
    for (int i = 0; i < 3; i++) {
      status = fbi_is_choice((int)state->mode[j][i], (int)FB_AXIS_COUNT - 1) ? status : FB_ERR_VALUE;
    }
    if (j < system->n_body && (fbi_is_ball(system->joint[j].kind) || system->method == FB_METHOD_MULTIPLIERS)) {
      fbi_copy(quat, state->link[j].quat, 4);
    }
    if (status == FB_OK && (!fbi_is_finite(state->hold[j], 3) || !fbi_is_finite(state->hold_quat[j], 4))) {
      status = FB_ERR_NOT_FINITE;
    }
    status = status == FB_OK && !fbi_quat_is_unit(quat) ? FB_ERR_VALUE : status;
  }
  return status;
}
#endif /* FB_WITH_SYSTEM */

#if FB_WITH_EXACT
/* ---------------------------------------------------------------------------------------------------------------
   RUN >>exact: the geometrically exact beam (uses config, status, vec3, rotation, solve, body) */

/* y = ad(x) v, the commutator of the twists x = (u, w) and v: (u x v_w + w x v_u, w x v_w) */
static void fbi_ad(fb_real y[6], const fb_real x[6], const fb_real v[6])
{
  fb_vec3_cross(y, x + 3, v);
  fbi_vec3_add_cross(y, x, v + 3);
  fb_vec3_cross(y + 3, x + 3, v + 3);
}

/* y = ad(x)^T F of a wrench F = (f, m): (f x w, f x u + m x w) */
static void fbi_adT(fb_real y[6], const fb_real x[6], const fb_real F[6])
{
  fb_vec3_cross(y, F, x + 3);
  fb_vec3_cross(y + 3, F, x);
  fbi_vec3_add_cross(y + 3, F + 3, x + 3);
}

/* Y = ad(x) M for 6x6 M, row by row so that compilers vectorize it. */
static void fbi_ad_mul(fb_real Y[36], const fb_real x[6], const fb_real M[36])
{
  for (int j = 0; j < 6; j++) {
    const fb_real *t = M + j, *b = M + 18 + j;
    Y[j] = x[4] * t[12] - x[5] * t[6] + x[1] * b[12] - x[2] * b[6];
    Y[6 + j] = x[5] * t[0] - x[3] * t[12] + x[2] * b[0] - x[0] * b[12];
    Y[12 + j] = x[3] * t[6] - x[4] * t[0] + x[0] * b[6] - x[1] * b[0];
    Y[18 + j] = x[4] * b[12] - x[5] * b[6];
    Y[24 + j] = x[5] * b[0] - x[3] * b[12];
    Y[30 + j] = x[3] * b[6] - x[4] * b[0];
  }
}

/* Y = ad(x)^T M */
static void fbi_adT_mul(fb_real Y[36], const fb_real x[6], const fb_real M[36])
{
  for (int j = 0; j < 6; j++) {
    const fb_real *t = M + j, *b = M + 18 + j;
    Y[j] = x[5] * t[6] - x[4] * t[12];
    Y[6 + j] = x[3] * t[12] - x[5] * t[0];
    Y[12 + j] = x[4] * t[0] - x[3] * t[6];
    Y[18 + j] = x[2] * t[6] - x[1] * t[12] + x[5] * b[6] - x[4] * b[12];
    Y[24 + j] = x[0] * t[12] - x[2] * t[0] + x[3] * b[12] - x[5] * b[0];
    Y[30 + j] = x[1] * t[0] - x[0] * t[6] + x[4] * b[0] - x[3] * b[6];
  }
}

/* Y = M ad(x): ad(x)^T on every row */
static void fbi_mul_ad(fb_real Y[36], const fb_real M[36], const fb_real x[6])
{
  for (int i = 0; i < 36; i += 6) {
    fbi_adT(Y + i, x, M + i);
  }
}

/* A += s v^ (cross-product matrix) on a 3x3 block of a matrix with n columns */
static void fbi_add_skew(fb_real *A, int n, fb_real s, const fb_real v[3])
{
  for (int k = 0; k < 3; k++) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    A[n * i + j] -= s * v[k];
    A[n * j + i] += s * v[k];
  }
}

/* Y += scale d(ad(x)^T F)/dx = scale [0 f^; f^ m^] */
static void fbi_adT_turn(fb_real Y[36], const fb_real F[6], fb_real scale)
{
  fbi_add_skew(Y + 3, 6, scale, F);
  fbi_add_skew(Y + 18, 6, scale, F);
  fbi_add_skew(Y + 21, 6, scale, F + 3);
}

static void fbi_mat66_mul_vec6(fb_real y[6], const fb_real A[36], const fb_real x[6])
{
  for (int i = 0; i < 6; i++) {
    y[i] = fbi_vec6_dot(A + 6 * i, x);
  }
}

/* C += A B */
static void fbi_mat66_add_mul(fb_real C[36], const fb_real A[36], const fb_real B[36])
{
  for (int i = 0; i < 36; i += 6) {
    for (int k = 0; k < 6; k++) {
      fbi_vec6_add(C + i, A[i + k], B + 6 * k);
    }
  }
}

/* Composition of poses: c = a b, b given in the axes of a. */
static void fbi_pose_mul(fb_real r_c[3], fb_real quat_c[4], const fb_real r_a[3], const fb_real quat_a[4],
                         const fb_real r_b[3], const fb_real quat_b[4])
{
  fb_real R[9], x[3], q[4];
  fb_quat_to_mat33(R, quat_a);
  fb_mat33_mul_vec3(x, R, r_b);
  for (int i = 0; i < 3; i++) {
    r_c[i] = r_a[i] + x[i];
  }
  fb_quat_mul(q, quat_a, quat_b);
  (void)fb_quat_normalize(q);
  fbi_copy(quat_c, q, 4);
}

/* Pose times the exponential of the twist x. */
static void fbi_pose_add(fb_real r[3], fb_real quat[4], const fb_real x[6])
{
  fb_real step[3], turn[4];
  fb_pose_from_twist(step, turn, x);
  fbi_pose_mul(r, quat, r, quat, step, turn);
}

/* Pose b relative to pose a, in the axes of a. */
static void fbi_pose_relative(fb_real r_c[3], fb_real quat_c[4], const fb_real r_a[3], const fb_real quat_a[4],
                              const fb_real r_b[3], const fb_real quat_b[4])
{
  const fb_real back[4] = {quat_a[0], -quat_a[1], -quat_a[2], -quat_a[3]};
  const fb_real d[3] = {r_b[0] - r_a[0], r_b[1] - r_a[1], r_b[2] - r_a[2]};
  fb_real R[9], y[3], q[4];
  fb_quat_to_mat33(R, quat_a);
  fb_mat33_mulT_vec3(y, R, d);
  fb_quat_mul(q, back, quat_b);
  fbi_copy(r_c, y, 3);
  fbi_copy(quat_c, q, 4);
}

/* Logarithm of the relative pose: twist from pose a to pose b, axes of a. */
static void fbi_pose_difference(fb_real x[6], const fb_real r_a[3], const fb_real quat_a[4], const fb_real r_b[3],
                                const fb_real quat_b[4])
{
  fb_real r[3], quat[4];
  fbi_pose_relative(r, quat, r_a, quat_a, r_b, quat_b);
  fb_pose_to_twist(x, r, quat);
}

/* ---- model */

/* Poses of the nodes by integrating the strains from the root; offset: E10.15; strain NULL: undeformed. */
static void fbi_exact_poses(fb_real *r, fb_real *quat, const fb_exact *m, const fb_real *strain, const fb_real *offset)
{
  for (int k = 0; k < m->n; k++) {
    fb_real x[6];
    for (int i = 0; i < 6; i++) {
      x[i] = m->h[k] * (m->xi[6 * k + i] + (strain ? strain[6 * k + i] + offset[6 * k + i] : FB_R(0.0)));
    }
    fbi_copy(r + 3 * k + 3, r + 3 * k, 3);
    fbi_copy(quat + 4 * k + 4, quat + 4 * k, 4);
    fbi_pose_add(r + 3 * k + 3, quat + 4 * k + 4, x);
  }
}

/* ---- one element */

/* y = A1 a + A2 b, A = 1/2 -+ ad(theta)/12: the mean over the element of a twist in section axes; d = b - a. */
static void fbi_exact_mean(fb_real y[6], fb_real d[6], const fb_real theta[6], const fb_real a[6], const fb_real b[6])
{
  for (int i = 0; i < 6; i++) {
    d[i] = b[i] - a[i];
  }
  fbi_ad(y, theta, d);
  for (int i = 0; i < 6; i++) {
    y[i] = FB_R(0.5) * (a[i] + b[i]) + y[i] / FB_R(12.0);
  }
}

/* The same mean of a vector, by the rotational part of theta alone. */
static void fbi_exact_mean3(fb_real y[3], const fb_real theta[6], const fb_real a[3], const fb_real b[3])
{
  const fb_real d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  fb_vec3_cross(y, theta + 3, d);
  for (int i = 0; i < 3; i++) {
    y[i] = FB_R(0.5) * (a[i] + b[i]) + y[i] / FB_R(12.0);
  }
}

/* [E10.7] Balance of an element: dF = ad(theta)^T s - h f, f = load + M g - momentum_t + ad(V)^T P, and the loads at
   its ends, F = s + (ad(theta)^T dF - h df)/12 -+ dF/2, so that the stress s is the mean of F over the element; df:
   difference of the dead loads and gravity between its ends.
   Source: [L] 3.92-3.95, 3.89 with Euler and Maclaurin's correction of the mean.  Cost: about 300 flops.  Fails: never.
   Test: elastica_is_of_order_four, steady_openfast_cantilever_hangs_as_shooting_says. */
static void fbi_exact_cell_eval(fbi_exact_cell *c, const fb_exact_work *work, const fb_exact *m, int k)
{
  const fbi_exact_motion *motion = &work->motion;
  const fb_real *const s = work->s + 6 * k, *const M = m->M + 36 * k;
  fb_real f[6], df[6], y[6];

  /* Strain from the stress, twist over the element */
  c->h = m->h[k];
  fbi_vec6_zero(c->P);
  fbi_vec6_zero(df);
  fbi_mat66_mul_vec6(c->strain, m->C + 36 * k, s);
  for (int i = 0; i < 6; i++) {
    c->theta[i] = c->h * (m->xi[6 * k + i] + c->strain[i] + work->offset[6 * k + i]);
  }

  /* Line loads: follower loads, then dead loads turned to section axes */
  fbi_vec6_copy(f, work->line + 6 * k);
  if (motion->dead) {
    const fb_real *const a = work->R + 9 * k, *const b = a + 9, *const n = work->line_dead + 6 * k;
    for (int i = 0; i < 6; i += 3) {
      fb_real p[3], q[3], mean[3];
      fb_mat33_mulT_vec3(p, a, n + i);
      fb_mat33_mulT_vec3(q, b, n + i);
      fbi_exact_mean3(mean, c->theta, p, q);
      fbi_vec3_add(f + i, FB_R(1.0), mean);
      fbi_vec3_add(df + i, -FB_R(1.0), p);
      fbi_vec3_add(df + i, FB_R(1.0), q);
    }
  }

  /* Gravity and inertia */
  if (motion->gravity) {
    fbi_exact_mean(y, c->dG, c->theta, work->G + 6 * k, work->G + 6 * k + 6);
    for (int i = 0; i < 6; i++) {
      f[i] += fbi_vec6_dot(M + 6 * i, y);
      df[i] += fbi_vec6_dot(M + 6 * i, c->dG);
    }
  }
  if (motion->inertia) {
    fbi_exact_mean(c->V, c->dV, c->theta, work->V + 6 * k, work->V + 6 * k + 6);
    fbi_mat66_mul_vec6(c->P, M, c->V);
    fbi_adT(y, c->V, c->P);
    for (int i = 0; i < 6; i++) {
      f[i] += y[i] - motion->shift * (c->P[i] - work->momentum[6 * k + i]);
    }
  }

  /* Change of the internal load over the element, and its values at both ends */
  fbi_adT(c->dF, c->theta, s);
  fbi_vec6_add(c->dF, -c->h, f);
  fbi_adT(y, c->theta, c->dF);
  for (int i = 0; i < 6; i++) {
    const fb_real mean = s[i] + (y[i] - c->h * df[i]) / FB_R(12.0);
    c->F1[i] = mean - FB_R(0.5) * c->dF[i];
    c->F2[i] = mean + FB_R(0.5) * c->dF[i];
  }
}

/* [E10.8] Compatibility of an element. Marching: h strain_t = V2 - V1 + ad(theta) V (= D1 V1 + D2 V2). Steady: theta is
   the twist between the poses of its ends. r: residual.
   Source: [L] 3.96-3.105 differentiated in time, with E10.7's mean (its adjoint).  Cost: 60 flops.  Fails: never.
   Test: energy_is_kept_whatever_the_step, steady_and_marching_agree. */
static void fbi_exact_compatibility(fb_real r[6], const fbi_exact_cell *c, const fb_exact_work *work, int k)
{
  fb_real y[6];
  if (!work->motion.march) {
    fbi_pose_difference(y, work->r + 3 * k, work->quat + 4 * k, work->r + 3 * k + 3, work->quat + 4 * k + 4);
    for (int i = 0; i < 6; i++) {
      r[i] = c->theta[i] - y[i];
    }
    return;
  }
  fbi_ad(y, c->theta, c->V);
  for (int i = 0; i < 6; i++) {
    r[i] = work->motion.shift * c->h * (c->strain[i] - work->strain[6 * k + i]) - c->dV[i] - y[i];
  }
}

/* D1, D2 = -+1 + ad(theta)/2 -+ ad(theta)^2/12, and -D1^T, D2^T in F1s, F2s. */
static void fbi_exact_strain_matrices(fbi_exact_jacobian *j, const fb_real theta[6])
{
  fb_real X[36], X2[36];
  fbi_zero(X2, 36);
  for (int i = 0; i < 36; i += 7) {
    X2[i] = FB_R(1.0);
  }
  fbi_ad_mul(X, theta, X2);
  fbi_ad_mul(X2, theta, X);
  for (int i = 0; i < 36; i++) {
    const int transposed = i % 6 * 6 + i / 6;
    const fb_real even = (i % 7 == 0 ? FB_R(1.0) : FB_R(0.0)) + X2[i] / FB_R(12.0), odd = FB_R(0.5) * X[i];
    j->D1[i] = odd - even;
    j->D2[i] = odd + even;
    j->F1s[transposed] = even - odd;
    j->F2s[transposed] = even + odd;
  }
}

/* Y = s X A, the derivative by the value at one end of s X times the mean, A = 1/2 -+ ad(theta)/12 (fbi_exact_mean);
   sign: -1 first end, 1 second. X_theta = X ad(theta); may be Y. */
static void fbi_exact_mean_by_end(fb_real Y[36], fb_real s, fb_real sign, const fb_real X[36],
                                  const fb_real X_theta[36])
{
  for (int i = 0; i < 36; i++) {
    Y[i] = s * (FB_R(0.5) * X[i] + sign / FB_R(12.0) * X_theta[i]);
  }
}

/* Inertia in the mean load h f by the unknowns d of an end node: Q = h N A marching; steady, where the velocity changes
   by T = shift + ad(V) with the pose: Q = h N A T. N = df/dV, N_theta = N ad(theta). */
static void fbi_exact_inertia_by_node(fb_real Q[36], const fb_real N[36], const fb_real N_theta[36],
                                      const fb_exact_work *work, int node, fb_real sign)
{
  const fbi_exact_motion *motion = &work->motion;
  fb_real NA[36];
  fbi_exact_mean_by_end(NA, work->cell.h, sign, N, N_theta);
  if (motion->march) {
    fbi_copy(Q, NA, 36);
    return;
  }
  fbi_mul_ad(Q, NA, work->V + 6 * node);
  for (int i = 0; i < 36; i++) {
    Q[i] += motion->shift * NA[i];
  }
}

/* Gravity in the mean load h f and in the difference h df/12, by the rotation of an end node, d times `pose`:
   Q += h pose M A ad(G), D = -+h pose M ad(G)/12, G the gravity there. */
static void fbi_exact_gravity_by_node(fb_real Q[36], fb_real D[36], const fb_real M[36], const fb_exact_work *work,
                                      int node, fb_real sign)
{
  const fb_real h_pose = work->cell.h * work->motion.pose, *const G = work->G + 6 * node;
  fb_real MA[36], MAG[36];
  fbi_mul_ad(MA, M, work->cell.theta);
  fbi_exact_mean_by_end(MA, h_pose, sign, M, MA);
  fbi_mul_ad(MAG, MA, G);
  fbi_mul_ad(D, M, G);
  for (int i = 0; i < 36; i++) {
    Q[i] += MAG[i];
    D[i] *= sign * h_pose / FB_R(12.0);
  }
}

/* The same of the dead line loads, d f = f x rotation: added to Q and D. line: force and torque, base axes. */
static void fbi_exact_dead_by_node(fb_real Q[36], fb_real D[36], const fb_real line[6], const fb_exact_work *work,
                                   int node, fb_real sign)
{
  const fb_real h_pose = work->cell.h * work->motion.pose;
  for (int i = 0; i < 6; i += 3) {
    fb_real f[3];
    fb_mat33_mulT_vec3(f, work->R + 9 * node, line + i);
    for (int a = 0; a < 3; a++) { /* column: rotation about axis a */
      fb_real turn[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)}, df[3], theta_df[3];
      turn[a] = FB_R(1.0);
      fb_vec3_cross(df, f, turn);
      fb_vec3_cross(theta_df, work->cell.theta + 3, df);
      for (int b = 0; b < 3; b++) {
        Q[6 * (i + b) + 3 + a] += h_pose * (FB_R(0.5) * df[b] + sign / FB_R(12.0) * theta_df[b]);
        D[6 * (i + b) + 3 + a] += sign * h_pose / FB_R(12.0) * df[b];
      }
    }
  }
}

/* Derivatives of the end loads F1, F2 of element k by the unknowns d of an end node: F1d = A1^T Q - D,
   F2d = -A2^T Q - D, with Q of the mean load h f and D of the end-to-end difference h df/12. */
static void fbi_exact_loads_by_node(fb_real F1d[36], fb_real F2d[36], const fb_real N[36], const fb_real N_theta[36],
                                    const fb_exact_work *work, const fb_exact *m, int k, int node)
{
  const fbi_exact_motion *motion = &work->motion;
  const fb_real sign = node == k ? -FB_R(1.0) : FB_R(1.0);
  fb_real Q[36], D[36], Y[36];
  fbi_zero(Q, 36);
  fbi_zero(D, 36);
  if (motion->inertia) {
    fbi_exact_inertia_by_node(Q, N, N_theta, work, node, sign);
  }
  if (motion->gravity) {
    fbi_exact_gravity_by_node(Q, D, m->M + 36 * k, work, node, sign);
  }
  if (motion->dead) {
    fbi_exact_dead_by_node(Q, D, work->line_dead + 6 * k, work, node, sign);
  }
  fbi_adT_mul(Y, work->cell.theta, Q);
  for (int i = 0; i < 36; i++) {
    const fb_real half = FB_R(0.5) * Q[i], twelfth = Y[i] / FB_R(12.0) + D[i];
    F1d[i] = half - twelfth;
    F2d[i] = -half - twelfth;
  }
}

/* N = df/dV = ad(V)^T M + d(ad(V)^T P)/dV - shift M, P fixed, and
   G = d(dF)/dtheta = d(ad(theta)^T s)/dtheta + h/12 (N ad(dV) + M ad(dG)), s fixed. */
static void fbi_exact_load_matrices(fb_real N[36], fb_real G[36], const fbi_exact_cell *c, const fb_exact_work *work,
                                    const fb_exact *m, int k)
{
  const fbi_exact_motion *motion = &work->motion;
  const fb_real *const M = m->M + 36 * k;
  fb_real Y[36];

  /* Stress, then inertia, gravity and dead loads */
  fbi_zero(N, 36);
  fbi_zero(G, 36);
  fbi_adT_turn(G, work->s + 6 * k, FB_R(1.0));
  if (motion->inertia) {
    fbi_adT_mul(N, c->V, M);
    fbi_adT_turn(N, c->P, FB_R(1.0));
    for (int i = 0; i < 36; i++) {
      N[i] -= motion->shift * M[i];
    }
    fbi_mul_ad(Y, N, c->dV);
    fbi_row_sub(G, -c->h / FB_R(12.0), Y, 36);
  }
  if (motion->gravity) {
    fbi_mul_ad(Y, M, c->dG);
    fbi_row_sub(G, -c->h / FB_R(12.0), Y, 36);
  }
  if (motion->dead) { /* -h (rotation x d)/12, d the difference of the dead loads between the ends */
    for (int i = 0; i < 6; i += 3) {
      fb_real p[3], q[3], d[3];
      fb_mat33_mulT_vec3(p, work->R + 9 * k, work->line_dead + 6 * k + i);
      fb_mat33_mulT_vec3(q, work->R + 9 * k + 9, work->line_dead + 6 * k + i);
      for (int a = 0; a < 3; a++) {
        d[a] = c->h / FB_R(12.0) * (q[a] - p[a]);
      }
      fbi_add_skew(G + 6 * i + 3, 6, FB_R(1.0), d);
    }
  }
}

/* E = (rate + ad(V) + ad(theta) ad(dV)/12) h C: derivative of the compatibility E10.8 by the stress. */
static void fbi_exact_compliance_rate(fb_real E[36], const fbi_exact_cell *c, const fb_exact_work *work,
                                      const fb_real hC[36])
{
  fb_real X[36], Y[36], one[36];
  fbi_copy(E, hC, 36);
  if (!work->motion.march) {
    return;
  }
  for (int i = 0; i < 36; i++) {
    E[i] *= work->motion.shift;
    one[i] = i % 7 == 0 ? FB_R(1.0) : FB_R(0.0);
  }
  fbi_ad_mul(X, c->dV, one);
  fbi_ad_mul(Y, c->theta, X);
  fbi_ad_mul(X, c->V, one);
  for (int i = 0; i < 36; i++) {
    X[i] += Y[i] / FB_R(12.0);
  }
  fbi_mat66_add_mul(E, X, hC);
}

/* [E10.9] Jacobian of E10.7 and E10.8: with N, G as above and the theta of the stress, h C ds,
     dF = ad(theta)^T ds + G dtheta - h (N A dV + ...),  F = s + ad(theta)^T dF/12 -+ dF/2.
   Source: derivation.  Cost: 5 kflops marching, 3 at rest.  Fails: never.
   Test: newton_converges_quadratically, shaft_whirls_as_in_closed_form, becks_column_flutters_at_its_load. */
static void fbi_exact_cell_jacobian(fbi_exact_jacobian *j, const fb_exact_work *work, const fb_exact *m, int k)
{
  const fbi_exact_motion *motion = &work->motion;
  const fbi_exact_cell *c = &work->cell;
  fb_real N[36], Q[36], G[36], Y[36], hC[36];
  for (int i = 0; i < 36; i++) {
    hC[i] = c->h * m->C[36 * k + i];
  }

  /* Derivatives by the motion of the two nodes */
  fbi_exact_strain_matrices(j, c->theta);
  fbi_exact_load_matrices(N, G, c, work, m, k);
  if (motion->inertia || motion->gravity || motion->dead) {
    fbi_mul_ad(Y, N, c->theta);
    fbi_exact_loads_by_node(j->F1d1, j->F2d1, N, Y, work, m, k, k);
    fbi_exact_loads_by_node(j->F1d2, j->F2d2, N, Y, work, m, k, k + 1);
  } else {
    fbi_zero(j->F1d1, 36);
    fbi_zero(j->F1d2, 36);
    fbi_zero(j->F2d1, 36);
    fbi_zero(j->F2d2, 36);
  }

  /* Derivatives of F1, F2 by theta (N, G), then through theta by the stress */
  fbi_adT_mul(Y, c->theta, G);
  fbi_zero(Q, 36);
  fbi_adT_turn(Q, c->dF, FB_R(1.0) / FB_R(12.0));
  for (int i = 0; i < 36; i++) {
    const fb_real mean = Q[i] + Y[i] / FB_R(12.0);
    N[i] = mean - FB_R(0.5) * G[i];
    G[i] = mean + FB_R(0.5) * G[i];
  }
  fbi_mat66_add_mul(j->F1s, N, hC);
  fbi_mat66_add_mul(j->F2s, G, hC);
  fbi_exact_compliance_rate(j->E, c, work, hC);
}

/* ---- the chain */

/* [E10.18] Load on a node, section axes: applied loads and, for each lumped body, M g - momentum_t + ad(V)^T P as for
   an element.
   Source: [L] 3.92, 3.93.  Cost: 200 flops a body.  Fails: never.
   Test: becks_column_flutters_at_its_load, newton_converges_quadratically. */
static void fbi_exact_node_eval(fb_real F[6], const fb_exact_work *work, const fb_exact *m, int node)
{
  const fbi_exact_motion *motion = &work->motion;
  const fb_real *const V = work->V + 6 * node;

  /* Follower and dead loads */
  fbi_vec6_copy(F, work->follower + 6 * node);
  for (int i = 0; i < 6; i += 3) {
    fb_real f[3];
    fb_mat33_mulT_vec3(f, work->R + 9 * node, work->dead + 6 * node + i);
    fbi_vec3_add(F + i, FB_R(1.0), f);
  }

  /* Gravity and inertia of the lumped bodies */
  for (int l = 0; l < m->n_lump; l++) {
    const fb_real *const M = m->lump + 36 * l;
    fb_real P[6], y[6];
    if (m->lump_node[l] != node) {
      continue;
    }
    if (motion->gravity) {
      fbi_mat66_mul_vec6(y, M, work->G + 6 * node);
      fbi_vec6_add(F, FB_R(1.0), y);
    }
    if (motion->inertia) {
      fbi_mat66_mul_vec6(P, M, V);
      fbi_adT(y, V, P);
      for (int i = 0; i < 6; i++) {
        F[i] += y[i] - motion->shift * (P[i] - work->lump[6 * l + i]);
      }
    }
  }
}

/* Derivative of E10.18 by the node's unknowns, subtracted from K. */
static void fbi_exact_node_jacobian(fb_real K[36], const fb_exact_work *work, const fb_exact *m, int node)
{
  const fbi_exact_motion *motion = &work->motion;
  const fb_real *const V = work->V + 6 * node;
  fb_real f[6], N[36], Q[36];

  /* Dead loads: -f x rotation */
  for (int i = 0; i < 6; i += 3) {
    fb_mat33_mulT_vec3(f + i, work->R + 9 * node, work->dead + 6 * node + i);
  }
  fbi_add_skew(K + 3, 6, -motion->pose, f);
  fbi_add_skew(K + 21, 6, -motion->pose, f + 3);

  /* Gravity and inertia of the lumped bodies */
  for (int l = 0; l < m->n_lump; l++) {
    const fb_real *const M = m->lump + 36 * l;
    if (m->lump_node[l] != node) {
      continue;
    }
    if (motion->gravity) {
      fbi_mul_ad(Q, M, work->G + 6 * node);
      for (int i = 0; i < 36; i++) {
        K[i] -= motion->pose * Q[i];
      }
    }
    if (motion->inertia) {
      fb_real P[6];
      fbi_mat66_mul_vec6(P, M, V);
      fbi_adT_mul(N, V, M);
      fbi_adT_turn(N, P, FB_R(1.0));
      for (int i = 0; i < 36; i++) {
        N[i] -= motion->shift * M[i];
      }
      fbi_mul_ad(Q, N, V);
      for (int i = 0; i < 36; i++) {
        K[i] -= motion->march ? N[i] : Q[i] + motion->shift * N[i];
      }
    }
  }
}

/* Is a node constrained in some, but not all translations? Its force rows are then in base axes. */
static int fbi_exact_turned(int held)
{
  return (held & FB_END_PINNED) != 0 && (held & FB_END_PINNED) != FB_END_PINNED;
}

/* Rotates three rows of n columns to base axes. */
static void fbi_exact_rows_turn(fb_real *A, const fb_real R[9], int n)
{
  for (int j = 0; j < n; j++) {
    const fb_real x[3] = {A[j], A[n + j], A[2 * n + j]};
    fb_real y[3];
    fb_mat33_mul_vec3(y, R, x);
    A[j] = y[0];
    A[n + j] = y[1];
    A[2 * n + j] = y[2];
  }
}

/* Puts the constraints d = want in place of the balance rows of the constrained directions of a node. A: its rows, 6 x
   n, its own unknowns from column `own` on. */
static void fbi_exact_hold(fb_real *A, const fb_exact_work *work, const fb_exact *m, int node, int n, int own)
{
  const int held = m->held[node], turned = fbi_exact_turned(held);
  const fb_real *const R = work->R + 9 * node, *const B = work->B + 6 * node;
  if (turned) { /* d(R F) = R (dF + rotation x F) */
    fbi_add_skew(A + own + 3, n, -work->motion.pose, B);
    fbi_exact_rows_turn(A, R, n);
  }
  for (int i = 0; i < 6; i++) {
    if (held >> i & 1) {
      fbi_zero(A + n * i, n);
      for (int j = 0; j < 3; j++) {
        A[n * i + own + (i < 3 ? j : j + 3)] = turned && i < 3 ? R[3 * i + j] : i % 3 == j ? FB_R(1.0) : FB_R(0.0);
      }
    }
  }
}

/* The same for the right-hand side b of the node. */
static void fbi_exact_hold_rhs(fb_real b[6], const fb_exact_work *work, const fb_exact *m, int node)
{
  const int held = m->held[node];
  if (fbi_exact_turned(held)) {
    fbi_exact_rows_turn(b, work->R + 9 * node, 1);
  }
  for (int i = 0; i < 6; i++) {
    b[i] = held >> i & 1 ? work->want[6 * node + i] : b[i];
  }
}

/* Rows of element k in E10.10, from its Jacobian and K of its outer node: compatibility [E, -D2 | -D1], balance of the
   outer node [F2s, F2d2 + K | F2d1] under its constraints, as [LU | W]; balance of the inner node L = [F1s, F1d2]. */
static void fbi_exact_rows_fill(fb_exact_work *work, const fb_exact *m, const fb_real K[36], int k)
{
  const fbi_exact_jacobian *const j = &work->jacobian;
  fb_real *const A = work->LU + 144 * k, *const W = work->W + 72 * k, *const L = work->L + 72 * k;
  fb_real balance[6 * 18];
  for (int r = 0; r < 6; r++) {
    for (int i = 0; i < 6; i++) {
      A[12 * r + i] = j->E[6 * r + i];
      A[12 * r + 6 + i] = -j->D2[6 * r + i];
      W[6 * r + i] = -j->D1[6 * r + i];
      balance[18 * r + i] = j->F2s[6 * r + i];
      balance[18 * r + 6 + i] = j->F2d2[6 * r + i] + K[6 * r + i];
      balance[18 * r + 12 + i] = j->F2d1[6 * r + i];
      L[12 * r + i] = j->F1s[6 * r + i];
      L[12 * r + 6 + i] = j->F1d2[6 * r + i];
    }
  }
  fbi_exact_hold(balance, work, m, k + 1, 18, 6);
  for (int r = 0; r < 6; r++) {
    fbi_copy(A + 12 * (r + 6), balance + 18 * r, 12);
    fbi_copy(W + 6 * (r + 6), balance + 18 * r + 12, 6);
  }
}

/* Eliminates element k: W = A^-1 W, and K = -F1d1 + L W for the inner node. */
static fb_status fbi_exact_eliminate(fb_real K[36], fb_exact_work *work, int k)
{
  fb_real *const A = work->LU + 144 * k, *const W = work->W + 72 * k, *const L = work->L + 72 * k;
  fb_real scale[12];
  const fb_status status = fb_lu_factor(A, work->perm + 12 * k, scale, 12);
  if (status != FB_OK) {
    return status;
  }
  fbi_lu_solve_rows(W, work->column, A, work->perm + 12 * k, 12, 6);
  for (int r = 0; r < 6; r++) {
    for (int i = 0; i < 6; i++) {
      K[6 * r + i] = -work->jacobian.F1d1[6 * r + i];
    }
    for (int i = 0; i < 12; i++) {
      fbi_vec6_add(K + 6 * r, L[12 * r + i], W + 6 * i);
    }
  }
  return FB_OK;
}

/* [E10.10] Block elimination from the tip to the root, (ds, dd2) = y - W dd1 for each element: its compatibility and
   the balance of its outer node form one 12x12 block, factored with row pivoting; the outboard part enters the balance
   of the inner node by the Schur complement K = -(F1d1 - (F1s, F1d2) W).
   Source: own; block elimination ([GV] 4.5).  Cost: E10.9 and 7 kflops an element.  Fails: singular (free of load, or
   at a limit point).  Test: supports_are_those_of_the_textbook, newton_converges_quadratically. */
static fb_status fbi_exact_factor(fb_exact_work *work, const fb_exact *m)
{
  fb_real K[36], scale[6];
  fbi_zero(K, 36);
  for (int k = m->n - 1; k >= 0; k--) {
    fb_status status;
    fbi_exact_cell_eval(&work->cell, work, m, k);
    fbi_exact_cell_jacobian(&work->jacobian, work, m, k);
    fbi_exact_node_jacobian(K, work, m, k + 1);
    fbi_exact_rows_fill(work, m, K, k);
    status = fbi_exact_eliminate(K, work, k);
    if (status != FB_OK) {
      return status;
    }
  }

  /* the 6x6 block of the root remains */
  fbi_exact_node_jacobian(K, work, m, 0);
  fbi_exact_hold(K, work, m, 0, 6, 0);
  fbi_copy(work->root, K, 36);
  return fb_lu_factor(work->root, work->perm + 12 * m->n, scale, 6);
}

/* Newton corrections dd, ds for the residuals c of the elements and B of the nodes. */
static void fbi_exact_solve(fb_exact_work *work, const fb_exact *m)
{
  fb_real z[6], b[12], x[6] = {FB_R(0.0)}; /* zeroed: gcc -O3 warns of an uninitialized read that cannot happen */

  /* Forward elimination from the tip to the root */
  fbi_vec6_zero(z);
  for (int k = m->n; k >= 0; k--) {
    fb_real *const y = work->y + 12 * k;
    for (int i = 0; i < 6; i++) {
      b[6 + i] = z[i] - work->B[6 * k + i];
    }
    fbi_exact_hold_rhs(b + 6, work, m, k);
    if (k == 0) {
      fb_lu_solve(x, work->root, work->perm + 12 * m->n, b + 6, 6);
      break;
    }
    for (int i = 0; i < 6; i++) {
      b[i] = -work->c[6 * (k - 1) + i];
    }
    fb_lu_solve(y, work->LU + 144 * (k - 1), work->perm + 12 * (k - 1), b, 12);
    for (int i = 0; i < 6; i++) {
      z[i] = fbi_dot(work->L + 72 * (k - 1) + 12 * i, y, 12);
    }
  }

  /* Back-substitution from the root: (ds, dd2) = y - W dd1 */
  fbi_vec6_copy(work->dd, x);
  for (int k = 0; k < m->n; k++) {
    const fb_real *const y = work->y + 12 * (k + 1), *const d = work->dd + 6 * k;
    for (int i = 0; i < 6; i++) {
      work->ds[6 * k + i] = y[i] - fbi_vec6_dot(work->W + 72 * k + 6 * i, d);
      work->dd[6 * k + 6 + i] = y[6 + i] - fbi_vec6_dot(work->W + 72 * k + 36 + 6 * i, d);
    }
  }
}

/* Residuals c (compatibility of the elements) and B (balance of the nodes), and internal loads F at the nodes. */
static void fbi_exact_residual(fb_exact_work *work, const fb_exact *m)
{
  fbi_exact_cell *const c = &work->cell;

  /* Loads on the nodes */
  for (int j = 0; j <= m->n; j++) {
    fbi_exact_node_eval(work->F + 6 * j, work, m, j);
    for (int i = 0; i < 6; i++) {
      work->B[6 * j + i] = -work->F[6 * j + i];
    }
  }

  /* Elements: compatibility, and their end loads on the nodes */
  for (int k = 0; k < m->n; k++) {
    fbi_exact_cell_eval(c, work, m, k);
    fbi_exact_compatibility(work->c + 6 * k, c, work, k);
    fbi_vec6_copy(work->P + 6 * k, c->P);
    fbi_vec6_add(work->B + 6 * k, -FB_R(1.0), c->F1);
    fbi_vec6_add(work->B + 6 * k + 6, FB_R(1.0), c->F2);
    if (k == 0) {
      fbi_vec6_copy(work->F, c->F1);
    }
    fbi_vec6_copy(work->F + 6 * k + 6, c->F2);
  }
}

/* ---- loads, poses and velocities of the nodes */

/* Adds a load in the beam's units to dead (base axes) or follower (section axes). */
static void fbi_exact_load_add(fb_real *dead, fb_real *follower, fb_axes axes, const fb_real force[3],
                               const fb_real torque[3], fb_real unit, fb_real length, const fb_real base[9])
{
  fb_real f[6], g[6];
  for (int i = 0; i < 3; i++) {
    f[i] = force[i] * unit;
    f[i + 3] = torque[i] * unit / length;
  }
  for (int i = 0; i < 6; i += 3) {
    fb_mat33_mulT_vec3(g + i, base, f + i);
  }
  fbi_vec6_add(axes == FB_AXES_NODE ? follower : dead, FB_R(1.0), axes == FB_AXES_INERTIAL ? g : f);
}

/* [E10.15] Mean strain due to the linear variation of the internal load under a line load f:
   -h/12 (ad(h (1, 0, 0, curvature)) C + C1) f, the part of E10.6 that does not depend on the stress. Follower loads
   only: for dead loads its derivative by the rotation would be needed.
   Source: own, as E10.6.  Cost: 200 flops an element that is loaded.  Fails: never.
   Test: line_loads_are_exact_at_the_nodes. */
static void fbi_exact_offset(fb_exact_work *work, const fb_exact *m)
{
  fbi_zero(work->offset, 6 * m->n);
  for (int k = 0; k < m->n && !fbi_is_zero(work->line, 6 * m->n); k++) {
    fb_real X[6], bend[6], taper[6], y[6];
    fbi_mat66_mul_vec6(bend, m->section + 36 * k, work->line + 6 * k);
    fbi_mat66_mul_vec6(taper, m->taper + 36 * k, work->line + 6 * k);
    for (int i = 0; i < 6; i++) {
      X[i] = m->h[k] * m->xi[6 * k + i];
    }
    fbi_ad(y, X, bend);
    for (int i = 0; i < 6; i++) {
      work->offset[6 * k + i] = -m->h[k] / FB_R(12.0) * (y[i] + taper[i]);
    }
  }
}

/* Loads, gravity and motion of the base, times `part`, in the beam's units and the axes of the base at mid-step. */
static void fbi_exact_input_take(fb_exact_work *work, const fb_exact *m, const fb_real base_quat[4],
                                 const fb_exact_input *input, fb_real part, fb_real dt)
{
  fb_real base[9], turn[3], half[4], quat[4];
  fbi_exact_motion *const motion = &work->motion;

  /* Twist of the base, its attitude half a step ahead, gravity in its axes */
  for (int i = 0; i < 3; i++) {
    work->twist[i] = m->floating ? FB_R(0.0) : part * input->v[i] * m->time / m->length;
    work->twist[i + 3] = m->floating ? FB_R(0.0) : part * input->w[i] * m->time;
    turn[i] = FB_R(0.5) * dt * work->twist[i + 3];
  }
  fb_quat_from_rotvec(half, turn);
  fb_quat_to_mat33(work->half, half);
  fb_quat_mul(quat, base_quat, half);
  fb_quat_to_mat33(base, quat);
  fb_mat33_mulT_vec3(work->gravity, base, m->gravity);

  /* Loads on nodes and elements */
  fbi_zero(work->dead, 6 * (m->n + 1));
  fbi_zero(work->follower, 6 * (m->n + 1));
  fbi_zero(work->line, 6 * m->n);
  fbi_zero(work->line_dead, 6 * m->n);
  for (int l = 0; l < input->n_load; l++) {
    const fb_load *load = &input->load[l];
    fbi_exact_load_add(work->dead + 6 * load->node, work->follower + 6 * load->node, load->axes, load->force,
                       load->torque, part / m->force, m->length, base);
  }
  for (int k = 0; k < m->n; k++) {
    const fb_line_load *line = &input->line[k];
    fbi_exact_load_add(work->line_dead + 6 * k, work->line + 6 * k, line->axes, line->force, line->torque,
                       part * m->length / m->force, m->length, base);
  }

  /* Strain offset (E10.15), flags of the kinds of load, scaled gravity */
  fbi_exact_offset(work, m);
  motion->dead = !fbi_is_zero(work->line_dead, 6 * m->n);
  motion->gravity = !m->floating && !fbi_is_zero(m->gravity, 3); /* E11.35 */
  for (int i = 0; i < 3; i++) {
    work->gravity[i] *= part;
  }
}

/* Twist of a node fixed in the base, section axes. */
static void fbi_exact_carried(fb_real V[6], const fb_exact_work *work, const fb_real r[3], const fb_real R[9])
{
  fb_real v[3];
  fbi_copy(v, work->twist, 3);
  fbi_vec3_add_cross(v, work->twist + 3, r);
  fb_mat33_mulT_vec3(V, R, v);
  fb_mat33_mulT_vec3(V + 3, R, work->twist + 3);
}

/* Rotation relative to the base, velocity and gravity at the nodes. Steady: all nodes move with the base. Marching: at
   mid-step, rotated by the unknown velocity of the node and by the base's. */
static void fbi_exact_nodes_eval(fb_exact_work *work, const fb_exact *m)
{
  const fbi_exact_motion *motion = &work->motion;
  for (int j = 0; j <= m->n; j++) {
    fb_real *const R = work->R + 9 * j, *const G = work->G + 6 * j;
    fb_quat_to_mat33(R, work->quat + 4 * j);

    /* Rotation, and velocity in the steady case */
    if (motion->march) {
      fb_real turn[3], quat[4], own[9], ahead[9];
      for (int i = 0; i < 3; i++) {
        turn[i] = motion->pose * work->V[6 * j + 3 + i];
      }
      fb_quat_from_rotvec(quat, turn);
      fb_quat_to_mat33(own, quat);
      fb_mat33_mul(ahead, R, own);
      for (int i = 0; i < 3; i++) { /* R = half^T ahead */
        const fb_real row[3] = {work->half[i], work->half[3 + i], work->half[6 + i]};
        fb_mat33_mulT_vec3(R + 3 * i, ahead, row);
      }
    } else {
      fbi_exact_carried(work->V + 6 * j, work, work->r + 3 * j, R);
    }

    /* Gravity, section axes */
    fb_mat33_mulT_vec3(G, R, work->gravity);
    fbi_zero(G + 3, 3);
  }
}

/* Pose error of a constrained node: position in base axes, rotation in section axes. With one axis free (a hinge) the
   rotation error is the misalignment of this axis, since the rotation vector would contain the hinge angle. */
static void fbi_exact_pose_error(fb_real e[6], const fb_exact *m, const fb_real *r, const fb_real *quat, int node)
{
  const fb_real *const q = quat + 4 * node;
  const fb_real back[4] = {q[0], -q[1], -q[2], -q[3]};
  fb_real turn[4];

  /* Position and rotation vector */
  for (int i = 0; i < 3; i++) {
    e[i] = m->r[3 * node + i] - r[3 * node + i];
  }
  fb_quat_mul(turn, back, m->quat + 4 * node);
  fb_quat_to_rotvec(e + 3, turn);

  /* Hinge about axis i */
  for (int i = 0; i < 3; i++) {
    if ((m->held[node] & FB_END_GUIDED) == (FB_END_GUIDED & ~(FB_HOLD_RX << i))) {
      fb_real R[9], place[3], own[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)};
      own[i] = FB_R(1.0);
      fb_quat_to_mat33(R, turn);
      fb_mat33_mul_vec3(place, R, own);
      fb_vec3_cross(e + 3, own, place);
    }
  }
}

/* [E10.16] Drift correction of a constrained node, in the axes of its rows, projected orthogonally to the constraint
   force F so that it does no work: e - F (F.e)/F.F. Components of e in free directions are unused.
   Source: own.  Cost: 40 flops.  Fails: never.  Test: a_beam_held_twice_keeps_energy_and_place. */
static void fbi_exact_close(fb_real e[6], const fb_exact_work *work, const fb_exact *m, int node)
{
  const int held = m->held[node];
  fb_real F[6], size;
  fbi_vec6_copy(F, work->B + 6 * node);
  if (fbi_exact_turned(held)) {
    fbi_exact_rows_turn(F, work->R + 9 * node, 1);
  }
  for (int i = 0; i < 6; i++) {
    F[i] = held >> i & 1 ? F[i] : FB_R(0.0);
  }
  size = fbi_vec6_dot(F, F);
  if (size > FB_R(0.0)) {
    fbi_vec6_add(e, -fbi_vec6_dot(F, e) / size, F);
  }
}

/* [E10.17] Velocity of the base at the node, v + w x r, minus the node's own, in the axes of its rows. r: prescribed
   position in constrained directions, position at mid-step in free ones.
   Source: [L] 3.18.  Cost: 80 flops.  Fails: never.  Test: a_beam_slides_out_of_a_spinning_slot. */
static void fbi_exact_slip(fb_real y[6], const fb_exact_work *work, const fb_exact *m, int node)
{
  const fb_real *const R = work->R + 9 * node, *const V = work->V + 6 * node, *const w = work->twist + 3;
  fb_real own[3], carried[3], r[3];

  /* Position r */
  fb_mat33_mul_vec3(own, R, V);
  fbi_copy(carried, work->twist, 3);
  fbi_vec3_add_cross(carried, w, work->r + 3 * node);
  for (int i = 0; i < 3; i++) {
    r[i] =
        m->held[node] >> i & 1 ? m->r[3 * node + i] : work->r[3 * node + i] + work->motion.pose * (own[i] - carried[i]);
  }

  /* Relative velocity */
  fbi_copy(carried, work->twist, 3);
  fbi_vec3_add_cross(carried, w, r);
  fbi_vec3_add(carried, -FB_R(1.0), own);
  fb_mat33_mulT_vec3(y, R, carried);
  if (fbi_exact_turned(m->held[node])) {
    fbi_copy(y, carried, 3);
  }
  fb_mat33_mulT_vec3(y + 3, R, w);
  fbi_vec3_add(y + 3, -FB_R(1.0), V + 3);
}

/* Right-hand side of the constraints. Steady: pose error. Marching: velocity of the base plus drift correction / dt
   (not for the root, which is placed exactly after the step). aim: recompute the drift correction for the present
   reaction (E10.16); otherwise keep it, because with a small reaction the iteration on both would not converge. */
static void fbi_exact_want(fb_exact_work *work, const fb_exact *m, fb_real dt, int aim)
{
  for (int j = 0; j <= m->n; j++) {
    fb_real e[6], *const want = work->want + 6 * j, *const back = work->back + 6 * j;
    if (m->held[j] == 0) {
      continue;
    }

    /* Drift correction, in the axes of the rows */
    if (aim) {
      fbi_exact_pose_error(e, m, work->r, work->quat, j);
      fbi_vec6_copy(back, e);
      if (!fbi_exact_turned(m->held[j])) {
        fb_mat33_mulT_vec3(back, work->R + 9 * j, e);
      }
    }

    /* Constraint values */
    if (work->motion.march) {
      if (aim) {
        fbi_exact_close(back, work, m, j);
      }
      fbi_exact_slip(want, work, m, j);
      fbi_vec6_add(want, j > 0 ? FB_R(1.0) / dt : FB_R(0.0), back);
    } else {
      fbi_vec6_copy(want, back);
    }
  }
}

/* ---- steady states */

/* Relative size of the last correction: lengths over the beam's, rotations in radians, stresses over the largest one.
   The part of a stress correction explained by the round-off `rounding` of node positions is left out. */
static fb_real fbi_exact_change(const fb_exact_work *work, const fb_exact *m, fb_real step, fb_real rounding)
{
  fb_real pose = FB_R(0.0), stress = FB_R(0.0), largest = FB_R(1.0);
  for (int i = 0; i < 6 * (m->n + 1); i++) {
    pose = fbi_larger(pose, FB_FABS(work->dd[i]));
  }
  for (int k = 0; k < m->n; k++) {
    const fb_real *const s = work->s + 6 * k, *const ds = work->ds + 6 * k, *const S = m->S + 36 * k;
    for (int i = 0; i < 6; i++) {
      stress = fbi_larger(stress, FB_FABS(ds[i]) - rounding / m->h[k] * S[7 * i]);
      largest = fbi_larger(largest, FB_FABS(s[i]));
    }
  }
  if (!fbi_is_finite(work->dd, 6 * (m->n + 1)) || !fbi_is_finite(work->ds, 6 * m->n)) {
    return FB_HUGE;
  }
  return fbi_larger(step * pose, stress / largest);
}

static void fbi_exact_pose_copy(fb_exact_state *to, const fb_exact_work *work, const fb_exact *m)
{
  fbi_copy(to->r, work->r, 3 * (m->n + 1));
  fbi_copy(to->quat, work->quat, 4 * (m->n + 1));
  fbi_copy(to->stress[0], work->s, 6 * m->n);
}

static void fbi_exact_pose_take(fb_exact_work *work, const fb_exact_state *from, const fb_exact *m)
{
  fbi_copy(work->r, from->r, 3 * (m->n + 1));
  fbi_copy(work->quat, from->quat, 4 * (m->n + 1));
  fbi_copy(work->s, from->stress[0], 6 * m->n);
}

/* Are the counts that bound loops over a state within the capacities? */
static int fbi_exact_is_sized(const fb_exact *m)
{
  return m->n >= 1 && m->n <= FB_MAX_EXACT && m->n_lump >= 0 && m->n_lump <= FB_MAX_LUMPS;
}

FB_DEF fb_status fb_exact_check(const fb_exact *m)
{
  int sound;
  FBI_REQUIRE(m, FB_ERR_NULL);
  if (!fbi_exact_is_sized(m)) {
    return FB_ERR_CAPACITY;
  }

  /* Settings and units */
  sound = m->iterations >= 1 && m->iterations <= 20 && m->factorizations >= 1 && m->factorizations <= 20 &&
          m->length > FB_R(0.0) && m->length <= FB_HUGE && m->force > FB_R(0.0) && m->force <= FB_HUGE &&
          m->time > FB_R(0.0) && m->time <= FB_HUGE && m->beta >= FB_R(0.0) && m->beta <= FB_R(0.125) &&
          fbi_is_finite(m->gravity, 3);

  /* Tables */
  sound = sound && fbi_is_finite(m->xi, 6 * m->n) && fbi_is_finite(m->C, 36 * m->n) && fbi_is_finite(m->S, 36 * m->n) &&
          fbi_is_finite(m->section, 36 * m->n) && fbi_is_finite(m->taper, 36 * m->n) &&
          fbi_is_finite(m->M, 36 * m->n) && fbi_is_finite(m->M_inverse, 36 * m->n) &&
          fbi_is_finite(m->r, 3 * (m->n + 1)) && fbi_is_finite(m->quat, 4 * (m->n + 1)) &&
          fbi_is_finite(m->lump, 36 * m->n_lump) && fbi_is_finite(m->lump_inverse, 36 * m->n_lump);

  /* Ranges */
  for (int k = 0; sound && k <= m->n; k++) {
    sound = fbi_is_within(m->held[k], 127) && (k == m->n || (m->h[k] > FB_R(0.0) && m->h[k] <= FB_R(1.0)));
  }
  for (int k = 0; sound && k < m->n_lump; k++) {
    sound = fbi_is_within(m->lump_node[k], m->n);
  }
  return sound ? FB_OK : FB_ERR_VALUE;
}

/* By E8.40. */
FB_DEF unsigned fb_exact_crc(const fb_exact *m)
{
  unsigned crc;
  FBI_REQUIRE(m, 0);
  if (!fbi_exact_is_sized(m)) {
    return 0;
  }
  {
    const int whole[5] = {m->n, m->n_lump, m->iterations, m->factorizations, m->floating};
    const fb_real number[7] = {m->length, m->force, m->time, m->beta, m->gravity[0], m->gravity[1], m->gravity[2]};
    const fb_real *const table[6] = {m->C, m->S, m->section, m->taper, m->M, m->M_inverse};
    crc = fbi_crc_reals(fbi_crc_ints(0xFFFFFFFFu, whole, 5), number, 7, FB_SINGLE);
    for (int k = 0; k < 6; k++) {
      crc = fbi_crc_reals(crc, table[k], 36 * m->n, FB_SINGLE);
    }
  }
  crc = fbi_crc_ints(fbi_crc_ints(crc, m->held, m->n + 1), m->lump_node, m->n_lump);
  crc = fbi_crc_reals(fbi_crc_reals(crc, m->h, m->n, FB_SINGLE), m->xi, 6 * m->n, FB_SINGLE);
  crc = fbi_crc_reals(fbi_crc_reals(crc, m->r, 3 * (m->n + 1), FB_SINGLE), m->quat, 4 * (m->n + 1), FB_SINGLE);
  crc = fbi_crc_reals(crc, m->lump, 36 * m->n_lump, FB_SINGLE);
  return ~fbi_crc_reals(crc, m->lump_inverse, 36 * m->n_lump, FB_SINGLE);
}

static int fbi_exact_rates_are_finite(const fb_exact *m, const fb_exact_state *state)
{
  int finite = fbi_is_finite(state->strain_rate, 6 * m->n) && fbi_is_finite(state->momentum_rate, 6 * m->n) &&
               fbi_is_finite(state->lump_rate, 6 * m->n_lump) && fbi_is_finite(state->offset, 6 * m->n);
  for (int k = 0; k < 3; k++) {
    finite = finite && fbi_is_finite(state->V[k], 6 * (m->n + 1)) && fbi_is_finite(state->stress[k], 6 * m->n);
  }
  return finite && fbi_is_finite(state->force, 6 * (m->n + 1)) && fbi_is_finite(state->reaction, 6 * (m->n + 1)) &&
         fbi_is_finite(&state->step, 1) && fbi_is_finite(state->u, 3) && fbi_is_finite(state->lost, 3);
}

FB_DEF fb_status fb_exact_state_check(const fb_exact *m, const fb_exact_state *state)
{
  fb_real quat[4];
  FBI_REQUIRE(m && state, FB_ERR_NULL);
  FBI_REQUIRE(fbi_exact_is_sized(m), FB_ERR_CAPACITY);
  if (!fbi_is_finite(state->base_position, 3) || !fbi_is_finite(state->base_quat, 4) ||
      !fbi_is_finite(state->r, 3 * (m->n + 1)) || !fbi_is_finite(state->quat, 4 * (m->n + 1)) ||
      !fbi_is_finite(state->strain, 6 * m->n) || !fbi_is_finite(state->momentum, 6 * m->n) ||
      !fbi_is_finite(state->lump, 6 * m->n_lump) || !fbi_exact_rates_are_finite(m, state)) {
    return FB_ERR_NOT_FINITE;
  }
  for (int j = 0; j <= m->n; j++) {
    fbi_copy(quat, state->quat + 4 * j, 4);
    if (fb_quat_normalize(quat) != FB_OK) {
      return FB_ERR_VALUE;
    }
  }
  fbi_copy(quat, state->base_quat, 4);
  return fb_quat_normalize(quat) == FB_OK && state->known >= 0 && state->known <= 3 ? FB_OK : FB_ERR_VALUE;
}

static const fb_exact_input *fbi_exact_no_input(fb_exact_work *work)
{
  memset(&work->input, 0, sizeof work->input);
  return &work->input;
}

static fb_status fbi_exact_input_check(const fb_exact *m, const fb_exact_input *input)
{
  if (input->n_load < 0 || input->n_load > FB_MAX_LOADS) {
    return FB_ERR_CAPACITY;
  }
  if (!fbi_is_finite(input->v, 3) || !fbi_is_finite(input->w, 3)) {
    return FB_ERR_NOT_FINITE;
  }

  /* Loads on nodes */
  for (int l = 0; l < input->n_load; l++) {
    const fb_load *load = &input->load[l];
    if (load->node < 0 || load->node > m->n) {
      return FB_ERR_CAPACITY;
    }
    if (!fbi_is_choice((int)load->axes, (int)FB_AXES_COUNT - 1)) {
      return FB_ERR_VALUE;
    }
    if (!fbi_is_finite(load->force, 3) || !fbi_is_finite(load->torque, 3)) {
      return FB_ERR_NOT_FINITE;
    }
  }

  /* Line loads */
  for (int k = 0; k < m->n; k++) {
    const fb_line_load *line = &input->line[k];
    if (!fbi_is_choice((int)line->axes, (int)FB_AXES_COUNT - 1)) {
      return FB_ERR_VALUE;
    }
    if (!fbi_is_finite(line->force, 3) || !fbi_is_finite(line->torque, 3)) {
      return FB_ERR_NOT_FINITE;
    }
  }
  return FB_OK;
}

/* Reactions: residual of the balance at constrained nodes. */
static void fbi_exact_reactions(fb_real *reaction, const fb_exact_work *work, const fb_exact *m)
{
  for (int j = 0; j <= m->n; j++) {
    for (int i = 0; i < 6; i++) {
      reaction[6 * j + i] = m->held[j] ? work->B[6 * j + i] : FB_R(0.0);
    }
  }
}

/* State from the velocities, stresses and internal loads in work, with all rates zero. */
static void fbi_exact_state_take(fb_exact_state *state, fb_exact_work *work, const fb_exact *m)
{
  fbi_exact_cell *const c = &work->cell;

  /* Poses; no rates */
  fbi_exact_pose_copy(state, work, m);
  fbi_zero(state->strain_rate, 6 * m->n);
  fbi_zero(state->momentum_rate, 6 * m->n);
  fbi_zero(state->lump_rate, 6 * m->n_lump);

  /* Strains and momenta */
  for (int k = 0; k < m->n; k++) {
    fbi_mat66_mul_vec6(state->strain + 6 * k, m->C + 36 * k, work->s + 6 * k);
    fbi_exact_cell_eval(c, work, m, k);
    fbi_exact_mean(c->V, c->dV, c->theta, work->V + 6 * k, work->V + 6 * k + 6);
    fbi_mat66_mul_vec6(state->momentum + 6 * k, m->M + 36 * k, c->V);
  }
  for (int l = 0; l < m->n_lump; l++) {
    fbi_mat66_mul_vec6(state->lump + 6 * l, m->lump + 36 * l, work->V + 6 * m->lump_node[l]);
  }

  /* Reactions, internal loads and the first known velocity */
  fbi_copy(state->offset, work->offset, 6 * m->n);
  fbi_exact_reactions(state->reaction, work, m);
  fbi_copy(state->V[0], work->V, 6 * (m->n + 1));
  fbi_copy(state->force, work->F, 6 * (m->n + 1));
  state->known = 1;
}

/* ---- the velocity u of the frame */

/* The velocity u of a state in its base axes, in the beam's units. */
static void fbi_exact_frame(fb_real u[3], const fb_exact *m, const fb_exact_state *state)
{
  fb_real base[9];
  fb_quat_to_mat33(base, state->base_quat);
  fb_mat33_mulT_vec3(u, base, state->u);
  for (int i = 0; i < 3; i++) {
    u[i] *= m->time / m->length;
  }
}

/* The same at the middle of the last step: the frame of a floating beam falls freely (E11.35). */
static void fbi_exact_frame_middle(fb_real u[3], const fb_exact *m, const fb_exact_state *state)
{
  fb_real base[9], g[3];
  fbi_exact_frame(u, m, state);
  fb_quat_to_mat33(base, state->base_quat);
  fb_mat33_mulT_vec3(g, base, m->gravity);
  fbi_vec3_add(u, m->floating ? -FB_R(0.5) * state->step : FB_R(0.0), g);
}

/* Twist of a node for a common translational velocity u: section axes. */
static void fbi_exact_seen(fb_real V[6], const fb_exact_state *state, int node, const fb_real u[3])
{
  fb_real R[9];
  fb_quat_to_mat33(R, state->quat + 4 * node);
  fb_mat33_mulT_vec3(V, R, u);
  fbi_zero(V + 3, 3);
}

/* The same for element k, by the mean of E10.7. */
static void fbi_exact_seen_mean(fb_real V[6], const fb_exact *m, const fb_exact_state *state, int k, const fb_real u[3])
{
  fb_real a[6], b[6], theta[6], d[6];
  for (int i = 0; i < 6; i++) {
    theta[i] = m->h[k] * (m->xi[6 * k + i] + state->strain[6 * k + i] + state->offset[6 * k + i]);
  }
  fbi_exact_seen(a, state, k, u);
  fbi_exact_seen(b, state, k + 1, u);
  fbi_exact_mean(V, d, theta, a, b);
}

/* Adds a wrench in section axes of a node to force p and moment h about the origin of the base, base axes. */
static void fbi_exact_wrench_add(fb_real p[3], fb_real h[3], const fb_exact_state *state, int node, const fb_real F[6])
{
  fb_real R[9], y[3];
  fb_quat_to_mat33(R, state->quat + 4 * node);
  fb_mat33_mul_vec3(y, R, F);
  fbi_vec3_add(p, FB_R(1.0), y);
  fbi_vec3_add_cross(h, state->r + 3 * node, y);
  fb_mat33_mul_vec3(y, R, F + 3);
  fbi_vec3_add(h, FB_R(1.0), y);
}

/* Momentum and angular momentum about the origin of the base, base axes: of the state relative to its frame (u NULL),
   or of all nodes moving by u. */
static void fbi_exact_momenta(fb_real p[3], fb_real h[3], const fb_exact *m, const fb_exact_state *state,
                              const fb_real *u)
{
  fb_real P[6], V[6];

  /* Elements: h A^T P at both nodes */
  fbi_zero(p, 3);
  fbi_zero(h, 3);
  for (int k = 0; k < m->n; k++) {
    fb_real theta[6], y[6], first[6], second[6];
    fbi_vec6_copy(P, state->momentum + 6 * k);
    if (u) {
      fbi_exact_seen_mean(V, m, state, k, u);
      fbi_mat66_mul_vec6(P, m->M + 36 * k, V);
    }
    for (int i = 0; i < 6; i++) {
      theta[i] = m->h[k] * (m->xi[6 * k + i] + state->strain[6 * k + i] + state->offset[6 * k + i]);
    }
    fbi_adT(y, theta, P);
    for (int i = 0; i < 6; i++) {
      first[i] = m->h[k] * (FB_R(0.5) * P[i] - y[i] / FB_R(12.0));
      second[i] = m->h[k] * (FB_R(0.5) * P[i] + y[i] / FB_R(12.0));
    }
    fbi_exact_wrench_add(p, h, state, k, first);
    fbi_exact_wrench_add(p, h, state, k + 1, second);
  }

  /* Lumped bodies */
  for (int l = 0; l < m->n_lump; l++) {
    fbi_vec6_copy(P, state->lump + 6 * l);
    if (u) {
      fbi_exact_seen(V, state, m->lump_node[l], u);
      fbi_mat66_mul_vec6(P, m->lump + 36 * l, V);
    }
    fbi_exact_wrench_add(p, h, state, m->lump_node[l], P);
  }
}

static fb_real fbi_exact_mass(const fb_exact *m)
{
  fb_real mass = FB_R(0.0);
  for (int k = 0; k < m->n; k++) {
    const fb_real *const M = m->M + 36 * k;
    mass += m->h[k] * (M[0] + M[7] + M[14]) / FB_R(3.0);
  }
  for (int l = 0; l < m->n_lump; l++) {
    mass += m->lump[36 * l];
  }
  return mass;
}

/* Changes the frame velocity u by `more` (beam's units, base axes) and subtracts its contribution from the velocities
   of the nodes, the momenta and their rates. du is the change of u that round-off left. */
static void fbi_exact_reframe(fb_exact_state *state, const fb_exact *m, const fb_real more[3], fb_real step)
{
  fb_real V[6], P[6], base[9], y[3], du[3];

  /* New u, and its change du after round-off */
  fb_quat_to_mat33(base, state->base_quat);
  fb_mat33_mul_vec3(y, base, more);
  for (int i = 0; i < 3; i++) {
    const fb_real before = state->u[i];
    state->u[i] += m->length / m->time * y[i];
    y[i] = (state->u[i] - before) * (m->time / m->length);
  }
  fb_mat33_mulT_vec3(du, base, y);

  /* Momenta of the elements, and their rates as the sections rotate */
  for (int k = 0; k < m->n; k++) {
    const fb_real *const a = state->V[0] + 6 * k, *const M = m->M + 36 * k;
    fb_real turn[3], rate[6];
    fbi_exact_seen_mean(V, m, state, k, du);
    fbi_mat66_mul_vec6(P, M, V);
    fbi_vec6_add(state->momentum + 6 * k, -FB_R(1.0), P);
    for (int i = 0; i < 3; i++) {
      turn[i] = FB_R(0.5) * (a[i + 3] + a[i + 9]);
    }
    fbi_vec6_zero(rate);
    fb_vec3_cross(rate, V, turn);
    fbi_mat66_mul_vec6(P, M, rate);
    fbi_vec6_add(state->momentum_rate + 6 * k, -FB_R(1.0), P);
  }

  /* Lumped bodies */
  for (int l = 0; l < m->n_lump; l++) {
    const int j = m->lump_node[l];
    fb_real rate[6];
    fbi_exact_seen(V, state, j, du);
    fbi_mat66_mul_vec6(P, m->lump + 36 * l, V);
    fbi_vec6_add(state->lump + 6 * l, -FB_R(1.0), P);
    fbi_vec6_zero(rate);
    fb_vec3_cross(rate, V, state->V[0] + 6 * j + 3);
    fbi_mat66_mul_vec6(P, m->lump + 36 * l, rate);
    fbi_vec6_add(state->lump_rate + 6 * l, -FB_R(1.0), P);
  }

  /* Velocities of the nodes at this and the earlier steps */
  for (int j = 0; j <= m->n; j++) {
    fb_real turn[3];
    fbi_exact_seen(V, state, j, du);
    fb_vec3_cross(turn, state->V[0] + 6 * j + 3, V); /* minus the rate: earlier steps */
    for (int k = 0; k < 3; k++) {
      fbi_vec3_add(state->V[k] + 6 * j, -FB_R(1.0), V);
      fbi_vec3_add(state->V[k] + 6 * j, -step * ((fb_real)k + FB_R(0.5)), turn);
    }
  }
}

FB_DEF fb_status fb_exact_state_init(const fb_exact *m, fb_exact_state *state, fb_exact_work *work,
                                     const fb_exact_input *input)
{
  const fbi_exact_motion still = {0, 0, 0, 0, 0, 0};
  FBI_REQUIRE(m && state && work, FB_ERR_NULL);
  FBI_REQUIRE_EXACT();
  FBI_REQUIRE(fbi_exact_is_sized(m), FB_ERR_CAPACITY);
  if (input && (!fbi_is_finite(input->v, 3) || !fbi_is_finite(input->w, 3))) {
    return FB_ERR_NOT_FINITE;
  }

  /* Undeformed poses */
  memset(state, 0, sizeof *state);
  state->base_quat[0] = FB_R(1.0);
  fbi_copy(state->r, m->r, 3 * (m->n + 1));
  fbi_copy(state->quat, m->quat, 4 * (m->n + 1));
  fbi_exact_pose_take(work, state, m);

  /* No loads, prescribed velocity */
  work->motion = still;
  fbi_zero(work->gravity, 3);
  fbi_zero(work->line, 6 * m->n);
  fbi_zero(work->offset, 6 * m->n);
  fbi_zero(work->F, 6 * (m->n + 1));
  fbi_zero(work->B, 6 * (m->n + 1));
  for (int i = 0; i < 3; i++) {
    state->u[i] = input ? input->v[i] : FB_R(0.0);
    work->twist[i] = FB_R(0.0);
    work->twist[i + 3] = input ? input->w[i] * m->time : FB_R(0.0);
  }

  /* Velocities and momenta */
  fbi_exact_nodes_eval(work, m);
  fbi_exact_state_take(state, work, m);
  if (m->floating && fbi_exact_mass(m) > FB_R(0.0)) { /* u = velocity of the mass center by the spin about O */
    fb_real du[3], h[3];
    fbi_exact_momenta(du, h, m, state, NULL);
    for (int i = 0; i < 3; i++) {
      du[i] /= fbi_exact_mass(m);
    }
    fbi_exact_reframe(state, m, du, FB_R(0.0));
    fbi_zero(state->momentum_rate, 6 * m->n);
    fbi_zero(state->lump_rate, 6 * m->n_lump);
  }
  return FB_OK;
}

/* ---- outputs */

/* Nearest whole number. */
static fb_real fbi_round(fb_real x)
{
  return (fb_real)(int)(x + (x < FB_R(0.0) ? -FB_R(0.5) : FB_R(0.5)));
}

/* Rotation vector of quat nearest to the given phi among all that differ by full turns. */
static void fbi_rotvec_near(fb_real phi[3], const fb_real quat[4])
{
  const fb_real near_to[3] = {phi[0], phi[1], phi[2]};
  const fb_real turn = FB_R(6.283185307179586), axis = fbi_vec3_norm(near_to);
  fb_real size;
  fb_quat_to_rotvec(phi, quat);
  size = fbi_vec3_norm(phi);
  if (size < FB_R(1e-3) && axis > FB_R(3.0)) { /* near full turns: take the axis of the given vector */
    fbi_vec3_add(phi, fbi_round(axis / turn) * turn / axis, near_to);
  } else if (size > FB_R(0.0)) {
    const fb_real turns = fbi_round((fb_vec3_dot(near_to, phi) / size - size) / turn);
    fbi_vec3_add(phi, turns * turn / size, phi);
  }
}

FB_DEF fb_status fb_exact_nodes_eval(const fb_exact *m, fb_exact_node *node, const fb_exact_state *state)
{
  fb_real base[9], phi[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)}, u[3], frame[6];
  fb_status status;
  FBI_REQUIRE(m && node && state, FB_ERR_NULL);
  status = fb_exact_state_check(m, state);
  if (status != FB_OK) {
    return status;
  }

  /* Attitude of the base, velocity of the frame */
  fb_quat_to_mat33(base, state->base_quat);
  fbi_exact_frame_middle(u, m, state);

  /* Outputs in SI units */
  for (int j = 0; j <= m->n; j++) {
    fb_exact_node *const out = &node[j];
    const fb_real *const q0 = m->quat + 4 * j, *const V = state->V[0] + 6 * j, *const F = state->force + 6 * j;
    const fb_real *const B = state->reaction + 6 * j;
    const fb_real back[4] = {q0[0], -q0[1], -q0[2], -q0[3]};
    fb_real turn[4], r[3];
    fb_mat33_mul_vec3(r, base, state->r + 3 * j);
    fb_quat_mul(out->quat, state->base_quat, state->quat + 4 * j);
    fb_quat_mul(turn, back, state->quat + 4 * j);
    fbi_rotvec_near(phi, turn);
    fb_quat_to_wiener_milenkovic(out->wiener_milenkovic, turn);
    fbi_exact_seen(frame, state, j, u);
    for (int i = 0; i < 3; i++) {
      out->position[i] = state->base_position[i] + m->length * r[i];
      out->displacement[i] = m->length * (state->r[3 * j + i] - m->r[3 * j + i]);
      out->rotation[i] = phi[i];
      out->velocity[i] = (V[i] + frame[i]) * m->length / m->time;
      out->angular_rate[i] = V[i + 3] / m->time;
      out->force[i] = F[i] * m->force;
      out->moment[i] = F[i + 3] * m->force * m->length;
      out->reaction_force[i] = B[i] * m->force;
      out->reaction_moment[i] = B[i + 3] * m->force * m->length;
    }
  }
  return FB_OK;
}

FB_DEF fb_status fb_exact_element_eval(const fb_exact *m, fb_exact_element *out, const fb_exact_state *state, int k)
{
  fb_status status;
  FBI_REQUIRE(m && out && state, FB_ERR_NULL);
  FBI_REQUIRE(k >= 0 && k < m->n, FB_ERR_CAPACITY);
  status = fb_exact_state_check(m, state);
  if (status != FB_OK) {
    return status;
  }
  {
    const fb_real *const s = state->stress[0] + 6 * k;
    const fb_real mass = m->force * m->time * m->time / m->length; /* of the beam */
    fb_real strain[6], V[6], P[6], u[3], frame[6];

    /* Strain, and velocity and momentum with those of the frame */
    fbi_mat66_mul_vec6(strain, m->section + 36 * k, s);
    fbi_mat66_mul_vec6(V, m->M_inverse + 36 * k, state->momentum + 6 * k);
    fbi_exact_frame(u, m, state);
    fbi_exact_seen_mean(frame, m, state, k, u);
    fbi_mat66_mul_vec6(P, m->M + 36 * k, frame);
    fbi_vec6_add(P, FB_R(1.0), state->momentum + 6 * k);
    fbi_vec6_add(V, FB_R(1.0), frame);

    /* SI units */
    for (int i = 0; i < 3; i++) {
      out->force[i] = s[i] * m->force;
      out->moment[i] = s[i + 3] * m->force * m->length;
      out->force_strain[i] = strain[i];
      out->moment_strain[i] = strain[i + 3] / m->length;
      out->velocity[i] = V[i] * m->length / m->time;
      out->angular_rate[i] = V[i + 3] / m->time;
      out->momentum[i] = P[i] * mass / m->time;
      out->angular_momentum[i] = P[i + 3] * mass * m->length / m->time;
    }
  }
  return FB_OK;
}

/* [E10.12] Pose at the fraction s (0..1) of an element: exp(s theta), then the contribution of the linear variation of
   the strain, (s^2 - s)/2 h (C (F2 - F1) + taper stress).
   Source: own; the strain is linear to this order.  Cost: 200 flops.  Fails: never.
   Test: points_between_nodes_lie_on_the_curve. */
static void fbi_exact_point(fb_real r[3], fb_real quat[4], const fb_exact *m, const fb_exact_state *state, int k,
                            fb_real s)
{
  fb_real x[6], dF[6], bend[6], taper[6];
  for (int i = 0; i < 6; i++) {
    x[i] = s * m->h[k] * (m->xi[6 * k + i] + state->strain[6 * k + i] + state->offset[6 * k + i]);
    dF[i] = state->force[6 * k + 6 + i] - state->force[6 * k + i];
  }
  fbi_mat66_mul_vec6(bend, m->section + 36 * k, dF);
  fbi_mat66_mul_vec6(taper, m->taper + 36 * k, state->stress[0] + 6 * k);
  for (int i = 0; i < 6; i++) {
    bend[i] = FB_R(0.5) * s * (s - FB_R(1.0)) * m->h[k] * (bend[i] + taper[i]);
  }
  fbi_copy(r, state->r + 3 * k, 3);
  fbi_copy(quat, state->quat + 4 * k, 4);
  fbi_pose_add(r, quat, x);
  fbi_pose_add(r, quat, bend);
}

FB_DEF fb_status fb_exact_point_eval(const fb_exact *m, fb_real position[3], fb_real quat[4],
                                     const fb_exact_state *state, fb_real x)
{
  fb_status status;
  fb_real r[3], turn[4], R[9], place = FB_R(0.0);
  int k = 0;
  FBI_REQUIRE(m && position && quat && state, FB_ERR_NULL);
  if (!(x >= FB_R(0.0) && x <= m->length * (FB_R(1.0) + FB_R(1e-5)))) {
    return FB_ERR_VALUE;
  }
  status = fb_exact_state_check(m, state);
  if (status != FB_OK) {
    return status;
  }

  /* Element that contains x */
  x /= m->length;
  while (k + 1 < m->n && place + m->h[k] < x) {
    place += m->h[k];
    k++;
  }

  /* Pose in the base, then in inertial axes */
  fbi_exact_point(r, turn, m, state, k, (x - place) / m->h[k]);
  fb_quat_to_mat33(R, state->base_quat);
  fb_mat33_mul_vec3(position, R, r);
  fb_quat_mul(quat, state->base_quat, turn);
  for (int i = 0; i < 3; i++) {
    position[i] = state->base_position[i] + m->length * position[i];
  }
  return FB_OK;
}

/* 1/2 x.A x + part rate.A rate */
static fb_real fbi_exact_quadratic(const fb_real A[36], const fb_real x[6], const fb_real rate[6], fb_real part)
{
  fb_real y[6], z[6];
  fbi_mat66_mul_vec6(y, A, x);
  fbi_mat66_mul_vec6(z, A, rate);
  return FB_R(0.5) * fbi_vec6_dot(x, y) + part * fbi_vec6_dot(rate, z);
}

/* mass (origin + g . r) + g . R moment for the inertia matrix M at the pose r, quat; moment: first moment of mass. For
   curved elements E10.6 makes mass and moment differ between axes: their means are used, which are invariant. */
static fb_real fbi_exact_weight(const fb_real M[36], const fb_real g[3], fb_real origin, const fb_real r[3],
                                const fb_real quat[4])
{
  const fb_real mass = (M[0] + M[7] + M[14]) / FB_R(3.0);
  const fb_real moment[3] = {FB_R(0.5) * (M[11] - M[16]), FB_R(0.5) * (M[15] - M[5]), FB_R(0.5) * (M[4] - M[9])};
  fb_real R[9], y[3];
  fb_quat_to_mat33(R, quat);
  fb_mat33_mulT_vec3(y, R, g);
  return mass * (origin + fb_vec3_dot(g, r)) + fb_vec3_dot(moment, y);
}

/* [E10.13] Energy: 1/2 h strain S strain + 1/2 h P M^-1 P + u.p + 1/2 m u.u, p the momentum relative to u, and -m g.r
   with the mass center's r, by Simpson's rule along each element.
   Source: [L] 3.57-3.61.  Cost: 400 flops an element.  Fails: state refused.
   Test: energy_is_kept_whatever_the_step, a_pendulum_keeps_its_energy, flight_at_any_speed_moves_as_rest_does. */
FB_DEF fb_status fb_exact_energy_eval(const fb_exact *m, fb_energy *energy, const fb_exact_state *state)
{
  fb_energy out = {FB_R(0.0), FB_R(0.0), FB_R(0.0)};
  fb_real base[9], g[3], u[3], p[3], turning[3], origin, last, unit;
  fb_status status;
  FBI_REQUIRE(m && energy && state, FB_ERR_NULL);
  status = fb_exact_state_check(m, state);
  if (status != FB_OK) {
    return status;
  }

  /* Units, gravity in base axes */
  last = FB_R(0.25) * m->beta * state->step * state->step;
  unit = m->force * m->length;
  fb_quat_to_mat33(base, state->base_quat);
  fb_mat33_mulT_vec3(g, base, m->gravity);
  origin = fb_vec3_dot(m->gravity, state->base_position) / m->length;

  /* Elements */
  for (int k = 0; k < m->n; k++) {
    const fb_real h = m->h[k], *const M = m->M + 36 * k, *const r = state->r + 3 * k, *const quat = state->quat + 4 * k;
    fb_real middle[3], turn[4];
    fbi_exact_point(middle, turn, m, state, k, FB_R(0.5));
    out.strain +=
        h * fbi_exact_quadratic(m->S + 36 * k, state->strain + 6 * k, state->strain_rate + 6 * k, last) * unit;
    out.kinetic +=
        h * unit *
        fbi_exact_quadratic(m->M_inverse + 36 * k, state->momentum + 6 * k, state->momentum_rate + 6 * k, last);
    out.gravity -= h * unit / FB_R(6.0) *
                   (fbi_exact_weight(M, g, origin, r, quat) + fbi_exact_weight(M, g, origin, r + 3, quat + 4) +
                    FB_R(4.0) * fbi_exact_weight(M, g, origin, middle, turn));
  }

  /* Lumped bodies */
  for (int l = 0; l < m->n_lump; l++) {
    const fb_real *const M = m->lump + 36 * l;
    const int j = m->lump_node[l];
    out.kinetic +=
        unit * fbi_exact_quadratic(m->lump_inverse + 36 * l, state->lump + 6 * l, state->lump_rate + 6 * l, last);
    out.gravity -= unit * fbi_exact_weight(M, g, origin, state->r + 3 * j, state->quat + 4 * j);
  }

  /* Kinetic energy of the frame velocity */
  fbi_exact_frame(u, m, state);
  fbi_exact_momenta(p, turning, m, state, NULL);
  out.kinetic += unit * (fb_vec3_dot(u, p) + FB_R(0.5) * fbi_exact_mass(m) * fb_vec3_dot(u, u));
  if (!fbi_energy_is_finite(&out)) {
    return FB_ERR_NOT_FINITE;
  }
  *energy = out;
  return FB_OK;
}

/* [E10.14] Momentum and angular momentum about the inertial origin: h A^T P of each element at its two nodes
   (the adjoint of the mean velocity), plus m u and the angular momentum of a common velocity u of all nodes.
   Source: [L] 3.62, E10.7.  Cost: 200 flops an element.  Fails: state refused.  Test: free_flight_keeps_momentum. */
FB_DEF fb_status fb_exact_momentum_eval(const fb_exact *m, fb_momentum *momentum, const fb_exact_state *state)
{
  fb_momentum out;
  fb_real base[9], u[3], p[3], h[3], carried[3], turning[3], unit;
  fb_status status;
  FBI_REQUIRE(m && momentum && state, FB_ERR_NULL);
  status = fb_exact_state_check(m, state);
  if (status != FB_OK) {
    return status;
  }

  /* Base axes, about the origin of the base */
  fbi_exact_frame(u, m, state);
  fbi_exact_momenta(p, h, m, state, NULL);
  fbi_exact_momenta(carried, turning, m, state, u);
  fbi_vec3_add(p, fbi_exact_mass(m), u);
  fbi_vec3_add(h, FB_R(1.0), turning);

  /* Inertial axes, SI units, about the inertial origin */
  unit = m->force * m->time; /* of momentum */
  fb_quat_to_mat33(base, state->base_quat);
  fb_mat33_mul_vec3(out.linear, base, p);
  fb_mat33_mul_vec3(out.angular, base, h);
  for (int i = 0; i < 3; i++) {
    out.linear[i] *= unit;
    out.angular[i] *= unit * m->length;
  }
  fbi_vec3_add_cross(out.angular, state->base_position, out.linear);
  if (!fbi_is_finite(out.linear, 3) || !fbi_is_finite(out.angular, 3)) {
    return FB_ERR_NOT_FINITE;
  }
  *momentum = out;
  return FB_OK;
}
#endif /* FB_WITH_EXACT */

/* ---------------------------------------------------------------------------------------------------------------
   RUN >>integrate: every step and its limit (uses config, status, vec3, rotation, solve, body, system, exact) */

/* Bound of the highest frequency (E8.8) of deflected, stretched beams: with slope s and strain e
   k <= (sqrt(limit_elastic) + s sqrt(limit_slope))^2 + e limit_slope, the triangle inequality for u_x' + s u_y'. */
static fb_real fbi_frequency_bound(const fb_body *body, fb_real spin, fb_real acceleration, fb_real slope,
                                   fb_real strain)
{
  const fb_real g = FB_FABS(spin) + FB_R(0.5) * body->limit_damping;
  fb_real k = body->limit_spin * spin * spin + body->limit_acceleration * FB_FABS(acceleration);
#if FB_WITH_NONLINEAR_STRAIN
  const fb_real root = FB_SQRT(body->limit_elastic) + slope * FB_SQRT(body->limit_slope);
  k += root * root + strain * body->limit_slope;
#else
  k += body->limit_elastic;
  (void)slope, (void)strain;
#endif
  return g + FB_SQRT(g * g + k);
}

/* radius / bound: largest step of an integrator that is stable up to |lambda| dt = radius */
static fb_real fbi_step_limit(fb_real radius, fb_real bound)
{
  if (!(bound >= FB_R(0.0))) { /* not a number: no step is stable */
    return FB_R(0.0);
  }
  return bound * FB_HUGE > radius ? radius / bound : FB_HUGE;
}

/* [E11.1] Largest stable step of rk4: |lambda| dt <= 2.785, the end of its stability region on the real axis (2.828 on
   the imaginary one), with the frequency bound of E8.8, which exceeds the |lambda| of damped modes by more than the
   region is narrower between the axes (2.616 at 122 degrees).
   Source: [HW] IV.2.  Cost: 10 flops, a square root.  Fails: never.
   Test: the_step_limit_is_the_stability_boundary. */
#define FBI_RK4_RADIUS FB_R(2.785)
FB_DEF fb_real fb_rk4_limit(const fb_body *body, fb_real spin, fb_real acceleration)
{
  FBI_REQUIRE(body, FB_R(0.0));
  return fbi_step_limit(FBI_RK4_RADIUS, fbi_frequency_bound(body, spin, acceleration, FB_R(0.0), FB_R(0.0)));
}

/* Position, attitude and momenta of the frame: out = state + s rate; out may be state */
static void fbi_frame_advance(fb_state *out, const fb_state *state, fb_real s, const fb_state *rate)
{
  fbi_vec3_advance(out->rho, state->rho, s, rate->rho);
  fbi_vec4_advance(out->quat, state->quat, s, rate->quat);
  fbi_vec3_advance(out->u, state->u, s, rate->u);
  fbi_vec3_advance(out->L, state->L, s, rate->L);
  fbi_vec3_advance(out->h, state->h, s, rate->h);
}

/* The modes of out = state + s rate. */
static void fbi_modes_advance(fb_state *out, const fb_state *state, fb_real s, const fb_state *rate, int n)
{
  for (int a = 0; a < n; a++) {
    out->q[a] = state->q[a] + s * rate->q[a];
    out->pi[a] = state->pi[a] + s * rate->pi[a];
  }
}

/* out = s rate */
static void fbi_state_scale(fb_state *out, fb_real s, const fb_state *rate, int n)
{
  for (int i = 0; i < 3; i++) {
    out->rho[i] = s * rate->rho[i];
    out->quat[i] = s * rate->quat[i];
    out->u[i] = s * rate->u[i];
    out->L[i] = s * rate->L[i];
    out->h[i] = s * rate->h[i];
  }
  out->quat[3] = s * rate->quat[3];
  for (int a = 0; a < n; a++) {
    out->q[a] = s * rate->q[a];
    out->pi[a] = s * rate->pi[a];
  }
}

/* Stage value out = state + s rate of all that rates depend on; L only in forms other than the momentum form. */
static void fbi_stage_advance(fb_state *out, const fb_body *body, const fb_state *state, fb_real s,
                              const fb_state *rate)
{
  fbi_vec4_advance(out->quat, state->quat, s, rate->quat);
  fbi_vec3_advance(out->u, state->u, s, rate->u);
  fbi_vec3_advance(out->h, state->h, s, rate->h);
  if (fbi_form(body) != 0) {
    fbi_vec3_advance(out->L, state->L, s, rate->L);
  }
  fbi_modes_advance(out, state, s, rate, body->n);
}

/* out = state + s rate; out may be state */
static void fbi_state_advance(fb_state *out, const fb_state *state, fb_real s, const fb_state *rate, int n)
{
  fbi_frame_advance(out, state, s, rate);
  fbi_modes_advance(out, state, s, rate, n);
}

/* [E11.2] Flush: values below the least, FB_TINY where cubes would underflow, become zero; NaN stays NaN. Compilers
   make a selection of it, not a branch (the instruction count of a step is checked to be the same for every step).
   Source: IEEE 754.  Cost: 2 n flops.  Fails: never.  Test: decay_reaches_zero_without_subnormals. */
static void fbi_flush(fb_real *x, int n, fb_real least)
{
  for (int i = 0; i < n; i++) {
    x[i] = FB_FABS(x[i]) < least ? FB_R(0.0) : x[i];
  }
}

#if FB_WITH_NONLINEAR_STRAIN
/* Largest slope and largest tensile strain at the stations. */
static void fbi_largest_slopes(fb_real *slope, fb_real *strain, const fbi_kinetics *k, int n_strain)
{
  fb_real r = FB_R(0.0);
  *strain = FB_R(0.0);
  for (int g = 0; g < n_strain; g++) {
    const fb_real square = k->slope[1][g] * k->slope[1][g] + k->slope[2][g] * k->slope[2][g];
    r = fbi_larger(r, square);
    *strain = fbi_larger(*strain, k->slope[0][g] + FB_R(0.5) * square);
  }
  *slope = FB_SQRT(r);
}
#endif

#define FBI_WORD_DT "dt [s], finite and above"
#define FBI_WORD_SPIN "dt [s] at this spin [rad/s], at most"
#define FBI_WORD_NEWTON "last Newton correction of a stage [rad], at most"
#define FBI_WORD_LOST "body: rotates so far in a step that its attitude is lost to round-off"
#define FBI_WORD_TURN "body: change of the angular velocity, times this dt [s], at most"

/* Arguments of the step limits: spin, and acceleration of O from the prescribed motion and gravity or, of a free base,
   from the rotation about the mass center and the loads. */
static void fbi_step_conditions(fb_real *spin, fb_real *acceleration, const fb_body *body, const fbi_kinetics *k,
                                const fb_input *input)
{
  fb_real a[3];
  *spin = fbi_vec3_norm(k->V + 3);

  /* Free base */
  if (body->base == FB_BASE_FREE) {
    fb_real by_loads = fbi_vec3_norm(fbi_is_flying(body) ? k->a : k->fg);
    by_loads = fbi_is_flying(body) ? by_loads : by_loads / body->mass;
    *acceleration = *spin * *spin * fbi_vec3_norm(body->c) / body->mass + by_loads;
    return;
  }

  /* Other bases */
  fbi_zero(a, 3);
  if (input && body->base == FB_BASE_PRESCRIBED) {
    fbi_given_acceleration(a, input);
  }
  *acceleration = fbi_vec3_norm(a);
#if FB_WITH_GRAVITY
  *acceleration += fbi_vec3_norm(body->gravity);
#endif
}

static fb_status fbi_rk4_check(const fb_body *body, const fbi_kinetics *k, const fb_input *input, fb_real dt)
{
  fb_real spin, acceleration, slope = FB_R(0.0), strain = FB_R(0.0), bound;
  fbi_step_conditions(&spin, &acceleration, body, k, input);
#if FB_WITH_NONLINEAR_STRAIN
  if (fbi_has(body->effects, FB_EFFECT_NONLINEAR_STRAIN)) {
    fbi_largest_slopes(&slope, &strain, k, body->n_strain);
  }
#endif
  bound = fbi_frequency_bound(body, spin, acceleration, slope, strain);
  return dt <= fbi_step_limit(FBI_RK4_RADIUS, bound)
             ? FB_OK
             : FBI_REFUSE_AT(FB_ERR_STEP, "dt [s] for the modes at this spin [rad/s], at most", -1, dt,
                             fbi_step_limit(FBI_RK4_RADIUS, bound), spin);
}

/* [E11.26] Refuses a step in which the angular velocity at a stage differs from that at the start by more than half a
   radian per step: no integrator resolves this motion, and the step limits of rk4 are evaluated at the start alone.
   Source: w = const over a step is what attitudes are summed by.
   Test: steps_that_turn_too_far_are_refused, slender_bodies_keep_their_energy. */
static fb_status fbi_turn_check(const fb_real start[3], const fb_real w[3], fb_real dt)
{
  const fb_real x = dt * (w[0] - start[0]), y = dt * (w[1] - start[1]), z = dt * (w[2] - start[2]);
  return x * x + y * y + z * z <= FB_R(0.25)
             ? FB_OK
             : FBI_REFUSE_AT(FB_ERR_STEP, FBI_WORD_TURN, -1, FB_SQRT(x * x + y * y + z * z), FB_R(0.5), dt);
}

/* [E11.22] Kahan (compensated) summation: d becomes the sum x + d, and `lost` its round-off error, which the next step
   adds: in single precision the increment of a step is often below the round-off of the sum. In double precision only
   positions (far from the origin) and u (in fast flight) are compensated.
   Source: W. Kahan, Comm. ACM 8, 1965.  Shapes: n.  Cost: 4 n flops.  Fails: never.
   Test: short_steps_lose_nothing, systems_lose_nothing_by_short_steps, positions_are_sums_without_loss,
   the_faintest_loads_add_up. */
static void fbi_sum_kept(fb_real *d, fb_real *lost, const fb_real *x, const fb_real *lost_before, int n)
{
  for (int i = 0; i < n; i++) {
    const fb_real more = d[i] + lost_before[i];
    d[i] = x[i] + more;
    lost[i] = more - (d[i] - x[i]);
  }
}

#define FBI_SUM_KEPT(d, x, what, n) fbi_sum_kept((d)->what, (d)->lost_##what, (x)->what, (x)->lost_##what, n)
#if FB_SINGLE
#define FBI_SUM(d, x, what, n) FBI_SUM_KEPT(d, x, what, n)
#define FBI_TAKE(x, y, what, n) fbi_copy((x)->what, (y)->what, n), fbi_copy((x)->lost_##what, (y)->lost_##what, n)
#define FBI_SUM_4(d, x, what) FBI_SUM_KEPT(d, x, what, 4)
#define FBI_SUM_3(d, x, what) FBI_SUM_KEPT(d, x, what, 3)
#define FBI_SUM_FLUSHED(d, x, what, n) FBI_SUM_KEPT(d, x, what, n), fbi_flush((d)->what, n, FB_TINY)
#else
/* x + d, and small values become zero (E11.2). */
static void fbi_sum_flushed(fb_real *d, const fb_real *x, int n)
{
  for (int i = 0; i < n; i++) {
    const fb_real sum = x[i] + d[i];
    d[i] = FB_FABS(sum) < FB_TINY ? FB_R(0.0) : sum;
  }
}

#define FBI_SUM(d, x, what, n) fbi_row_sub((d)->what, -FB_R(1.0), (x)->what, n)
#define FBI_TAKE(x, y, what, n) fbi_copy((x)->what, (y)->what, n)
#define FBI_SUM_3(d, x, what) fbi_vec3_add((d)->what, FB_R(1.0), (x)->what)
#define FBI_SUM_4(d, x, what) fbi_vec4_advance((d)->what, (d)->what, FB_R(1.0), (x)->what)
#define FBI_SUM_FLUSHED(d, x, what, n) fbi_sum_flushed((d)->what, (x)->what, n)
#endif

/* Copies the part of a state that a body uses, with its compensation terms. */
static void fbi_state_take(fb_state *state, const fb_state *next, int n)
{
  fbi_frame_copy(state, next);
  fbi_elastic_copy(state, next, n);
  fbi_vec3_copy(state->lost_rho, next->lost_rho);
  fbi_vec3_copy(state->lost_u, next->lost_u);
#if FB_SINGLE
  fbi_copy(state->lost_quat, next->lost_quat, 4);
  fbi_vec3_copy(state->lost_L, next->lost_L);
  fbi_vec3_copy(state->lost_h, next->lost_h);
  fbi_copy(state->lost_q, next->lost_q, n);
  fbi_copy(state->lost_pi, next->lost_pi, n);
#endif
}

/* Corrects d so that quat + d has unit length: adds (1/|quat + d| - 1) (quat + d). */
static fb_status fbi_quat_increment(fb_real d[4], const fb_real quat[4])
{
  fb_real sum[4], norm2 = FB_R(0.0), norm, s;
  for (int i = 0; i < 4; i++) {
    sum[i] = quat[i] + d[i];
    norm2 += sum[i] * sum[i];
  }
  if (!(norm2 > FB_R(1e-20) && norm2 < FB_HUGE)) {
    return FB_ERR_NOT_FINITE;
  }
  norm = FB_SQRT(norm2);
  s = (FB_R(1.0) - norm2) / (norm * (FB_R(1.0) + norm));
  for (int i = 0; i < 4; i++) {
    d[i] += s * sum[i];
  }
  return FB_OK;
}

/* [E11.29] Corrects the increment d of the attitude quat by the smallest rotation that takes a to b, the angular
   momentum integrated in body axes and in inertial axes: the inertial one is exact, the body one is exact about thin
   axes. No correction where the angular momentum changed by more than its own size.
   Source: L = R h.  Cost: 80 flops.  Fails: never.  Test: thin_tubes_keep_calm, slender_bodies_keep_their_energy. */
static void fbi_attitude_onto(fb_real d[4], const fb_real quat[4], const fb_real a[3], const fb_real b[3],
                              fb_real change)
{
  static const fb_real known[2] = {FB_R(0.0), FB_R(1.0)};
  const fb_real sizes = fbi_vec3_norm(a) * fbi_vec3_norm(b);
  fb_real theta[4] = {FB_R(0.0)}, more[4], told;

  /* Rotation vector a x b/(|a||b|), or zero */
  fb_vec3_cross(theta + 1, a, b);
  told = known[sizes > change * change]; /* table instead of a branch: same instruction count */
#if FB_SINGLE
  told *= known[fbi_vec3_norm(theta + 1) >= FB_R(16.0) * FB_EPSILON * sizes]; /* below: round-off of a and b */
#endif
  for (int i = 1; i < 4; i++) {
    theta[i] *= FB_R(0.5) * told / (sizes + (FB_R(1.0) - told));
  }

  /* Increment of the quaternion */
  fb_quat_mul(more, theta, quat);
  for (int i = 0; i < 4; i++) {
    d[i] += more[i];
  }
}

/* Applies E11.29 to the increments d of a free or pinned body. */
static FBI_NOINLINE void fbi_state_align(fb_state *d, const fb_body *body, const fb_state *start)
{
  fb_real quat[4], a[3], b[3], h[3];
  if (!fbi_is_turned(body)) {
    return;
  }
  fbi_vec4_advance(quat, start->quat, FB_R(1.0), d->quat);
  fbi_vec3_advance(h, start->h, FB_R(1.0), d->h);
  fbi_vec3_advance(b, start->L, FB_R(1.0), d->L);
  fbi_quat_turn(a, quat, h);
  fbi_attitude_onto(d->quat, quat, a, b, fbi_vec3_norm(d->L));
}

/* [E11.30] Position of O from that of the mass center, rho + int u dt + (R c/m)_old - (R c/m)_new: the angular momentum
   about the inertial origin is then conserved for any step. rho: int u dt; next: the rest of the state after the step.
   Old and new terms use the same operations, so that a body at rest leaves no round-off.
   Source: Newton.  Cost: 16 flops a term.  Fails: never.  Test: the_mass_center_goes_where_momentum_leads_it. */
static FBI_NOINLINE void fbi_origin_lead(fb_real rho[3], const fb_body *body, const fb_state *start,
                                         const fb_state *next)
{
  const fb_real share = FB_R(1.0) / body->mass;
  fb_real before[3], after[3], old[3], own[3];
  fbi_center_pair(before, after, body, start->q, next->q);
  fbi_quat_turn(old, start->quat, before);
  fbi_quat_turn(own, next->quat, after);
  for (int i = 0; i < 3; i++) {
    rho[i] += share * (old[i] - own[i]);
  }
}

/* [E11.31] Makes the elastic momenta of a body on a prescribed base relative to v, the last known velocity of the base
   (body axes at the attitude `at`). next: the state after the step, except that u is its change and pi its increment.
   Source: E8.35.  Cost: 5 flops a term.  Test: the_speed_of_a_prescribed_base_does_not_matter. */
static FBI_NOINLINE void fbi_frame_follow(fb_state *next, const fb_body *body, const fb_state *start,
                                          const fb_real at[4], const fb_real v[3])
{
  fb_real R[9];
  fb_quat_to_mat33(R, next->quat);
  if (at) {
    fbi_quat_turn(next->u, at, v);
  } else {
    fb_mat33_mul_vec3(next->u, R, v);
  }
  fbi_vec3_add(next->u, -FB_R(1.0), start->u);
  fbi_frame_shift(next->pi, body, next->q, R, next->u);
}

/* Common end of every step: sums the increments, flushes small values, normalizes the quaternion and checks the range
   of the model. start: the state with its h; last: the input at the attitude `at` (NULL: that of the end). FB_ERR_STEP:
   a rotation in one step so large that the attitude is lost to round-off. */
static fb_status fbi_step_end(fb_state *state, fb_state *next, const fb_state *start, const fb_body *body,
                              const fb_input *last, const fb_real at[4])
{
  const int n = body->n;
  fb_status status;

  /* Attitude and modes */
  fbi_state_align(next, body, start);
  status = fbi_quat_increment(next->quat, state->quat);
  FBI_SUM_4(next, state, quat);
  FBI_SUM_FLUSHED(next, state, q, n);
  if (fbi_is_following(body)) {
    fbi_frame_follow(next, body, start, at, last ? last->v : fbi_origin);
  }

  /* Momenta and velocity */
  FBI_SUM_FLUSHED(next, state, pi, n);
  FBI_SUM_KEPT(next, state, u, 3);
  FBI_SUM_3(next, state, L);
  fbi_flush(next->u, 3, FBI_FAINT);
  fbi_flush(next->L, 3, FBI_FAINT);
#if FB_SINGLE
  fbi_turning_keep(next, state, body, next->h);
#endif
  fbi_vec3_add(next->h, FB_R(1.0), start->h);

  /* Position */
  if (fbi_is_flying(body)) {
    fbi_origin_lead(next->rho, body, start, next);
  }
  FBI_SUM_KEPT(next, state, rho, 3);

  /* Range, then commit */
  status = status ? status : fbi_state_range(body, next);
  if (status == FB_OK && !fbi_quat_is_unit(next->quat)) {
    status = FBI_REFUSE(FB_ERR_STEP, FBI_WORD_LOST, -1, FB_R(0.0), FB_R(0.0));
  }
  if (status == FB_OK) {
    fbi_state_take(state, next, n);
  }
  return status;
}

/* WHAT A STEP OF ONE BODY RUNS, in the momentum form: NAME: what it calls, but for vectors, copies and what is off by
   default (check-rooms compares these lines with the code). The equations are those of the section body.
     fb_rk4_step: fbi_state_enter fbi_input_check fbi_rates fbi_rk4_check fbi_turn_check fbi_stage_advance fbi_step_end
     fbi_rates: fbi_velocity fbi_forces fbi_momentum_rates
     fbi_velocity: fbi_lambda_sub fbi_S_eval fbi_base_solve fbi_mass_solve fbi_given_velocity
     fbi_forces: fbi_load_add fbi_gravity_add fbi_fall
     fbi_load_add: fbi_node_eval fbi_node_quat
     fbi_momentum_rates: fbi_elastic_rates fbi_rigid_rates
     fbi_elastic_rates: fbi_lambda_gradients fbi_S_gradient fbi_elastic_forces fbi_mass_solve
     fbi_elastic_forces: fbi_sparse_eval fbi_damping_add fbi_strain_sub
     fbi_rk4_check: fbi_step_conditions fbi_largest_slopes fbi_frequency_bound fbi_step_limit
     fbi_step_end: fbi_state_align fbi_quat_increment fbi_frame_follow fbi_origin_lead fbi_state_range fbi_state_take */

/* [E11.3] Classical Runge-Kutta. Source: textbook.  Cost: 4 evaluations.  Test: rk4_converges_with_order_four. */
FB_DEF FBI_FLATTEN fb_status fb_rk4_step(const fb_body *body, fb_state *state, fb_rk4_work *work, const fb_input *start,
                                         const fb_input *middle, const fb_input *end, fb_real dt)
{
  static const fb_real node[3] = {FB_R(0.5), FB_R(0.5), FB_R(1.0)};
  static const fb_real weight[4] = {FB_R(1.0) / FB_R(6.0), FB_R(1.0) / FB_R(3.0), FB_R(1.0) / FB_R(3.0),
                                    FB_R(1.0) / FB_R(6.0)};
  const fb_input *input[4];
  const fb_state *at;
  fbi_kinetics k;
  fb_real spin[3] = {FB_R(0.0)};
  fb_status status = FB_OK;
  FBI_REQUIRE(body && state && work, FB_ERR_NULL);
  if (!(dt > FB_R(0.0) && dt < FB_HUGE)) {
    return FBI_REFUSE(FB_ERR_VALUE, FBI_WORD_DT, -1, dt, FB_R(0.0));
  }

  /* Inputs of the four stages */
  input[0] = start;
  input[1] = input[2] = middle;
  input[3] = end;
  at = &work->start;
  fbi_state_enter(&work->start, k.R, body, state);

  /* Stages */
  for (int stage = 0; stage < 4; stage++) {
    /* Rates */
    status = fbi_input_check(body, input[stage]);
    if (status == FB_OK) {
      status = fbi_rates(&work->rate, &k, body, at, input[stage]);
    }

    /* Step limit at the start, rotation at the last stage */
    if (status == FB_OK && stage == 0 && !body->allow_long_step) {
      status = fbi_rk4_check(body, &k, start, dt);
      fbi_vec3_copy(spin, k.V + 3);
    }
    if (status == FB_OK && stage == 3 && !body->allow_long_step) {
      status = fbi_turn_check(spin, k.V + 3, dt);
    }
    if (status != FB_OK) {
      return status;
    }

    /* Weighted sum of rates, value of the next stage */
    if (stage == 0) {
      fbi_state_scale(&work->sum, dt * weight[stage], &work->rate, body->n);
    } else {
      fbi_state_advance(&work->sum, &work->sum, dt * weight[stage], &work->rate, body->n);
    }
    if (stage < 3) {
      fbi_stage_advance(&work->stage, body, &work->start, dt * node[stage], &work->rate);
      if (fbi_is_oriented(body, input[stage + 1])) {
        fb_quat_to_mat33(k.R, work->stage.quat);
      }
      at = &work->stage;
    }
  }
  return fbi_step_end(state, &work->sum, &work->start, body, end, NULL);
}

/* ---- implicit integrators */

#define FBI_MAX_ITERATIONS 50
/* Tangent stiffness matrix at q to w.K. */
static void fbi_tangent(fb_implicit_work *w, const fb_body *body, const fb_real *q)
{
  fbi_sparse_to_dense(w->K, &body->K, body->n);
#if FB_WITH_NONLINEAR_STRAIN
  if (fbi_has(body->effects, FB_EFFECT_NONLINEAR_STRAIN)) {
    fb_real slope[3][FBI_MAX_STRAINS];
    fbi_slopes_eval(slope, body, q);
    fbi_strain_tangent_add(w->K, body, slope);
  }
#endif
  (void)q;
}

/* y += s N x with N_ab = -(Lambda_a^T V)_b, M times the transpose of the gyroscopic matrix. */
static void fbi_gyro_add(fb_real *y, fb_real s, const fb_real V[6], const fb_body *body, const fb_real *x)
{
  const fb_lambda_term *t = body->lambda + body->n_lambda_constant;
  for (const fb_lambda_row *r = body->lambda_row; r < body->lambda_row + body->n_row; r++) {
    const fb_real along = s * V[r->i];
    for (const fb_lambda_term *end = body->lambda + r->end; t < end; t++) {
      y[t->a - 1] += t->c * along * x[t->b];
    }
  }
}

/* D += s d/dq of the sum of c (1, q)_a (1, q)_b over n pairs, a >= b */
static void fbi_pairs_gradient(fb_real *D, fb_real s, const fb_real *c, const fb_S_pair *pair, int n, const fb_real *qx)
{
  for (int k = 0; k < n; k++) {
    const int a = pair[k].a, b = pair[k].b;
    const fb_real sc = s * c[k];
    D[a - 1] += sc * qx[b];
    if (b > 0) {
      D[b - 1] += sc * qx[a];
    }
  }
}

/* D_a = d/dq_a (Lambda(q) pb + S(q) V) of the free rows, rows x n: derivative of the rigid momenta by the modes. */
static void fbi_shape_rates(fb_real *D, const fbi_kinetics *k, const fb_body *body, int first)
{
  const int n = body->n;
  const fb_real *c = body->S;
  fbi_zero(D, (6 - first) * n);

  /* Lambda(q) pb */
  for (int t = body->n_lambda_constant; t < body->n_lambda; t++) {
    const fb_lambda_term *term = &body->lambda[t];
    if (term->i >= first) {
      D[(term->i - first) * n + term->a - 1] -= term->c * k->pb[term->b];
    }
  }

  /* S(q) V, S symmetric */
  for (const fb_S_run *r = body->run; r < body->run + body->n_run; r++) {
    const int i = fbi_sym6_row[r->i], j = fbi_sym6_column[r->i];
    if (i >= first) {
      fbi_pairs_gradient(D + (i - first) * n, k->V[j], c, body->pair + r->pair, r->n, k->qx);
    }
    if (j >= first && i != j) {
      fbi_pairs_gradient(D + (j - first) * n, k->V[i], c, body->pair + r->pair, r->n, k->qx);
    }
    c += r->n;
  }
}

/* X <- A^-1 X, rows x n, with the factors of fbi_lu_plain_factor */
static void fbi_rows_solve(fb_real *X, const fb_real *A, int rows, int n)
{
  for (int i = 1; i < rows; i++) {
    for (int j = 0; j < i; j++) {
      fbi_row_sub(X + i * n, A[i * rows + j], X + j * n, n);
    }
  }
  for (int i = rows - 1; i >= 0; i--) {
    for (int j = i + 1; j < rows; j++) {
      fbi_row_sub(X + i * n, A[i * rows + j], X + j * n, n);
    }
    for (int a = 0; a < n; a++) {
      X[i * n + a] *= A[i * rows + i];
    }
  }
}

/* y = (1 + g w^)^-1 x: solves with the Newton matrix of the gyroscopic term w x h. */
static void fbi_turning_solve(fb_real y[3], fb_real g, const fb_real w[3], const fb_real x[3])
{
  const fb_real a[3] = {g * w[0], g * w[1], g * w[2]}, s = FB_R(1.0) / (FB_R(1.0) + fb_vec3_dot(a, a));
  const fb_real along = fb_vec3_dot(a, x);
  fb_real turn[3];
  fb_vec3_cross(turn, a, x);
  for (int i = 0; i < 3; i++) {
    y[i] = s * (x[i] - turn[i] + along * a[i]);
  }
}

/* X <- (1 + g w^) X on the three rotational rows, rows x n; nothing for a hinge, whose one row w does not rotate.
   Multiplying instead of dividing keeps the pivots of a slender body positive. */
static void fbi_turning_mul(fb_real *X, fb_real g, const fb_real w[3], int first, int n)
{
  for (int a = 0; a < n && first <= 3; a++) {
    fb_real *const x = X + (3 - first) * n + a;
    const fb_real old[3] = {x[0], x[n], x[2 * n]};
    fb_real turn[3];
    fb_vec3_cross(turn, w, old);
    for (int i = 0; i < 3; i++) {
      x[i * n] += g * turn[i];
    }
  }
}

/* A -= g h^ on the rotational rows: derivative of w x h by w. */
static void fbi_turning_sub(fb_real *A, fb_real g, const fb_real h[3], int first)
{
  const fb_real cross[9] = {FB_R(0.0), -h[2], h[1], h[2], FB_R(0.0), -h[0], -h[1], h[0], FB_R(0.0)};
  const int rows = 6 - first;
  for (int i = 0; i < 9 && first <= 3; i++) {
    A[(3 + i / 3 - first) * rows + 3 + i % 3 - first] -= g * cross[i];
  }
}

/* Coupling of the free rigid rows to the modes at the present deformation: X = Lambda, Y = D - Lambda M^-1 N^T, Z =
   A^-1 (X + g Y) with the rigid mass matrix A, which for the momentum form is (1 + g w^) (S + Lambda M^-1 Lambda^T) - g
   h^, as are X + g Y then. */
static fb_status fbi_coupling(fb_implicit_work *w, const fbi_kinetics *k, const fb_body *body)
{
  const int n = body->n, first = fbi_first_free(body->base), rows = 6 - first, momentum = fbi_form(body) == 0;
  const fb_real *S = body->constant_S ? body->S0 : k->S;
  int terms = body->n_lambda;
  if (rows == 0) { /* no free rigid row */
    return FB_OK;
  }
#if FB_WITH_FORMS
  terms = momentum ? terms : body->n_lambda_value;
  S = body->form == FB_FORM_FIRST ? body->M_rr : S;
#endif

  /* X and Y */
  fbi_lambda_rows(w->X, body, k->qx, first, terms);
  if (momentum) {
    fbi_shape_rates(w->Y, k, body, first);
  } else {
    fbi_zero(w->Y, rows * n);
  }

  /* Y -= Lambda M^-1 N^T, rigid mass matrix A */
  S += 21 - rows * (rows + 1) / 2; /* of the free rows */
  for (int i = 0; i < rows; i++) {
    fb_real a[FB_MAX_MODES];
    if (momentum) {
      fbi_mass_solve(a, body, w->X + i * n);
      fbi_gyro_add(w->Y + i * n, -FB_R(1.0), w->V, body, a);
    }
    for (int j = i; j < rows; j++) {
      const fb_real elastic = momentum ? fbi_dot(a, w->X + j * n, n) : FB_R(0.0);
      w->A[i * rows + j] = w->A[j * rows + i] = *S++ + elastic;
    }
  }

  /* Gyroscopic terms of A, then its LU factors */
  if (momentum) {
    fbi_turning_mul(w->A, w->g, w->V + 3, first, rows);
    fbi_turning_sub(w->A, w->g, k->ph + 3, first);
  }
  if (fbi_lu_plain_factor(w->A, rows) != FB_OK) {
    return FB_ERR_RANGE;
  }

  /* Z = A^-1 (X + g Y) */
  for (int i = 0; i < rows * n; i++) {
    w->Z[i] = w->X[i] + w->g * w->Y[i];
  }
  if (momentum) {
    fbi_turning_mul(w->Z, w->g, w->V + 3, first, n);
  }
  fbi_rows_solve(w->Z, w->A, rows, n);
  return FB_OK;
}

/* [E11.4] Iteration matrix of the implicit integrators: k = (I - g W)^-1 r with g = gamma dt and W the Jacobian of the
   momentum form, q' = M^-1 (pi - Lambda^T V),  pi' = -K_t q - C q' + .., V = S^-1 (y - Lambda M^-1 pi),
   without the second derivatives of S and the products g^2 of gyroscopic terms, reduced to the n modes:
   E = M + g (C + N - N^T) + g^2 K_t - (X - g Y)^T Z. At g = 0 it is M - Lambda^T M_rr^-1 Lambda, the modal mass with a
   free base. The other forms have no N and Y.
   Source: block elimination; Newmark's effective stiffness is the case of a fixed base.  Shapes: n x n.  Cost: 2/3 n^3
   flops.
   Fails: M_rr or E singular.  Test: each_integrator_converges_at_its_order, steps_may_be_a_thousand_periods_long. */
static fb_status fbi_implicit_factor(fb_implicit_work *w, const fbi_kinetics *k, const fb_body *body, fb_real g)
{
  const int n = body->n, rows = 6 - fbi_first_free(body->base);
  fb_status status;

  /* X, Y, Z and A of the free base */
  w->g = g;
  fbi_copy(w->V, k->V, 6);
  status = fbi_coupling(w, k, body);
  if (status != FB_OK) {
    return status;
  }

  /* E = M + g^2 K_t + g (N - N^T) */
  fbi_tangent(w, body, k->qx + 1);
  fbi_sparse_to_dense(w->E, &body->M, n);
  fbi_row_sub(w->E, -g * g, w->K, n * n);
  for (int t = body->n_lambda_constant; t < body->n_lambda && fbi_form(body) == 0; t++) {
    const fb_lambda_term *term = &body->lambda[t];
    const int a = term->a - 1, b = term->b;
    w->E[a * n + b] += g * term->c * w->V[term->i];
    w->E[b * n + a] -= g * term->c * w->V[term->i];
  }

  /* Schur complement of the base, damping, LU factors */
  for (int i = 0; i < rows; i++) {
    for (int a = 0; a < n; a++) {
      fbi_row_sub(w->E + a * n, w->X[i * n + a] - g * w->Y[i * n + a], w->Z + i * n, n);
    }
  }
#if FB_WITH_DAMPING
  if (fbi_has(body->effects, FB_EFFECT_DAMPING)) {
    fbi_sparse_add(w->E, g, &body->C, n);
  }
#endif
  status = fbi_lu_plain_factor(w->E, n);
  return status == FB_ERR_SINGULAR ? FB_ERR_RANGE : status;
}

/* y -= s A x, A symmetric n x n */
static void fbi_symmetric_sub(fb_real *y, fb_real s, const fb_real *A, const fb_real *x, int n)
{
  for (int a = 0; a < n; a++) {
    fbi_row_sub(y, s * x[a], A + a * n, n);
  }
}

/* t = A^-1 ((1 + g w^) X u + g (0, r_h)): increments of the base velocity with the modes fixed; the gyroscopic
   terms in the momentum form only. */
static void fbi_base_answer(fb_real t[6], const fb_implicit_work *w, const fb_body *body, const fb_state *r,
                            const fb_real *u)
{
  const int first = fbi_first_free(body->base), rows = 6 - first;
  for (int i = 0; i < rows; i++) {
    t[i] = fbi_dot(w->X + i * body->n, u, body->n);
  }
  if (fbi_form(body) == 0) {
    fbi_turning_mul(t, w->g, w->V + 3, first, 1);
    for (int i = 0; i < 3; i++) {
      if (3 + i >= first) {
        t[3 + i - first] += w->g * r->h[i];
      }
    }
  }
  fbi_lu_plain_solve(t, w->A, rows);
}

/* Quaternion (1 - g w/2)^-1, which solves the implicit rate k = r + 1/2 g k o w of an attitude. */
static void fbi_turn_inverse(fb_real own[4], fb_real g, const fb_real w[3])
{
  const fb_real half = FB_R(0.5) * g, s = FB_R(1.0) / (FB_R(1.0) + half * half * fb_vec3_dot(w, w));
  own[0] = s;
  for (int i = 0; i < 3; i++) {
    own[1 + i] = s * half * w[i];
  }
}

/* Solution for attitude and h, which depend on the increment V (times g) of the base velocity: as implicit as the
   modes. */
static void fbi_recoil_pose(fb_state *r, const fb_implicit_work *w, const fb_body *body, const fbi_kinetics *k,
                            const fb_state *state, const fb_real V[6])
{
  fb_real own[4], turn[4], h[3];
  fbi_turn_inverse(own, w->g, w->V + 3);
  fbi_quat_rate(turn, state->quat, V + 3);
  for (int i = 0; i < 4; i++) {
    turn[i] += r->quat[i];
  }
  fb_quat_mul(r->quat, turn, own); /* k = r + 1/2 quat o dw + 1/2 g k o w */
  if (fbi_form(body) == 0 && body->base != FB_BASE_PRESCRIBED) {
    fbi_copy(h, r->h, 3);
    fbi_vec3_add_cross(h, k->ph + 3, V + 3);
    fbi_turning_solve(r->h, w->g, w->V + 3, h);
  }
}

/* [E11.5] r becomes k = (I - g W)^-1 r, with t of fbi_base_answer.
   Momentum form: E k_q = (M + g C + g N) r_q + g r_pi - (X - g Y)^T t,  g dV = t - Z k_q,  d = k_q - r_q,
   k_pi = r_pi - g K_t k_q - (C + N) d + Y^T g dV.
   The others, elastic velocities u:  E k_u = M r_u - X^T t - g K_t r_q,  k_q = r_q + g k_u,  k_V = r_V + t - Z k_u.
   Source: E11.4.  Cost: 4 n^2 + 50 n flops.  Fails: never.  Test: each_integrator_converges_at_its_order. */
static void fbi_implicit_solve(fb_state *r, const fb_implicit_work *w, const fb_body *body, const fbi_kinetics *k,
                               const fb_state *state)
{
  const int n = body->n, first = fbi_first_free(body->base), rows = 6 - first, momentum = fbi_form(body) == 0;
  const fb_real g = w->g;
  fb_real b[FB_MAX_MODES], d[FB_MAX_MODES], t[6], V[6] = {0};
  fb_real *u = momentum ? r->q : r->pi;

  /* Right-hand side of the modes */
  fbi_copy(d, u, n);
  fbi_mass_mul(b, body, u);
  fbi_base_answer(t, w, body, r, u);
  for (int i = 0; i < rows; i++) {
    fbi_row_sub(b, t[i], w->X + i * n, n);
    fbi_row_sub(b, -g * t[i], w->Y + i * n, n);
  }
  if (momentum) {
    fbi_row_sub(b, -g, r->pi, n);
    fbi_damping_add(b, g, body, r->q);
    fbi_gyro_add(b, g, w->V, body, r->q);
  } else {
    fbi_symmetric_sub(b, g, w->K, r->q, n);
  }

  /* Modes k_q (or k_u), velocity increment V of the base */
  fbi_lu_plain_solve(b, w->E, n);
  fbi_copy(u, b, n);
  for (int i = 0; i < rows; i++) {
    V[first + i] = t[i] - fbi_dot(w->Z + i * n, u, n);
  }
  for (int a = 0; a < n; a++) {
    d[a] = u[a] - d[a];
  }

  /* Momenta, or displacements and base velocity */
  if (momentum) {
    fbi_symmetric_sub(r->pi, g, w->K, r->q, n);
    fbi_damping_add(r->pi, -FB_R(1.0), body, d);
    fbi_gyro_add(r->pi, -FB_R(1.0), w->V, body, d);
    for (int i = 0; i < rows; i++) {
      fbi_row_sub(r->pi, -V[first + i], w->Y + i * n, n);
    }
  } else {
    fbi_row_sub(r->q, -g, r->pi, n);
    fb_real v[3];
    fb_mat33_mul_vec3(v, k->R, V);
    for (int i = 0; i < 3; i++) {
      r->u[i] += v[i];
      r->L[i] += V[3 + i];
      V[3 + i] = g * r->L[i];
    }
  }

  /* Position, attitude and h */
  fbi_vec3_add(r->rho, g, r->u);
  fbi_recoil_pose(r, w, body, k, state, V);
}

/* Frequency of the geometric stiffening by the quadratic displacement field. */
static fb_real fbi_stiffening(const fb_body *body, fb_real spin, fb_real acceleration)
{
  return FB_SQRT(body->limit_spin * spin * spin + body->limit_acceleration * FB_FABS(acceleration));
}

/* [E11.6] Largest step of the implicit integrators, set by the terms that their matrix leaves out, products of the spin
   and geometric stiffening by the quadratic displacement field: |w| dt <= 1/10, frequency of the latter times dt <= 1.
   Source: trials.  Fails: never.  Test: steps_within_the_limit_are_stable. */
FB_DEF fb_real fb_implicit_limit(const fb_body *body, fb_real spin, fb_real acceleration)
{
  FBI_REQUIRE(body, FB_R(0.0));
  return fbi_step_limit(FB_R(1.0), fbi_larger(FB_R(10.0) * FB_FABS(spin), fbi_stiffening(body, spin, acceleration)));
}

static fb_status fbi_implicit_check(const fb_body *body, const fbi_kinetics *k, const fb_input *input, fb_real dt)
{
  fb_real spin, acceleration;
  if (body->allow_long_step) {
    return FB_OK;
  }
  fbi_step_conditions(&spin, &acceleration, body, k, input);
  return dt <= fb_implicit_limit(body, spin, acceleration)
             ? FB_OK
             : FBI_REFUSE_AT(FB_ERR_STEP, FBI_WORD_SPIN, -1, dt, fb_implicit_limit(body, spin, acceleration), spin);
}

/* Start of an implicit step: rates at the state, step limit, factored iteration matrix. */
static fb_status fbi_implicit_start(fb_implicit_work *w, fbi_kinetics *k, const fb_body *body, const fb_state *state,
                                    const fb_input *input, fb_real dt, fb_real g)
{
  fb_status status = dt > FB_R(0.0) && dt < FB_HUGE ? fbi_input_check(body, input)
                                                    : FBI_REFUSE(FB_ERR_VALUE, FBI_WORD_DT, -1, dt, FB_R(0.0));
  fbi_state_enter(&w->start, k->R, body, state);
  if (status == FB_OK) {
    status = fbi_rates(&w->rate, k, body, &w->start, input);
  }
  status = status == FB_OK ? fbi_implicit_check(body, k, input, dt) : status;
  return status == FB_OK ? fbi_implicit_factor(w, k, body, g) : status;
}

/* [E11.25] Convergence of a stage. It fails if the last Newton correction exceeds a tenth of the first one, a hundredth
   of the increment of the stage, and round-off: corrections shrink to less than a tenth if the step resolves the
   motion. Arguments are squares; a single iteration cannot be judged.
   In systems modes are checked separately, against a tenth of their own increment.
   Source: contraction of Newton's method.  Test: steps_that_have_not_converged_say_so,
   a_fast_sled_does_not_hide_what_bends. */
static fb_status fbi_stage_check(fb_real first, fb_real last, fb_real change)
{
  const fb_real floor = FB_R(0.01) * FB_EPSILON;
  const fb_real bound = fbi_larger(fbi_larger(FB_R(0.01) * first, FB_R(1e-4) * change), floor);
  return last > bound ? FBI_REFUSE(FB_ERR_CONVERGENCE, FBI_WORD_NEWTON, -1, FB_SQRT(last), FB_SQRT(bound)) : FB_OK;
}

/* [E11.32] Squared size of the increment g k [rad^2], for E11.25: rotation of the attitude, modal displacements over
   the radius of gyration.
   Source: definition.  Cost: 2 n flops.  Test: implicit_steps_that_have_not_converged_say_so. */
static fb_real fbi_rate_size(const fb_state *k, const fb_body *body, fb_real g)
{
  const fb_real turn = k->quat[0] * k->quat[0] + fb_vec3_dot(k->quat + 1, k->quat + 1);
  fb_real bent = FB_R(0.0);
  for (int a = 0; a < body->n; a++) {
    bent += body->reach[a] * FB_FABS(k->q[a]);
  }
  bent = body->gyration > FB_R(0.0) ? bent / body->gyration : bent;
  return g * g * (FB_R(4.0) * turn + bent * bent);
}

/* Simplified Newton iterations for k = f(base + g k), k holds the first guess: (I - g W) dk = f - k. */
static fb_status fbi_stage_solve(fb_implicit_work *w, fb_state *k, const fb_body *body, const fbi_kinetics *at,
                                 const fb_state *base, const fb_input *input, int iterations, fb_real dt)
{
  fb_status status = fbi_input_check(body, input);
  fb_real first = FB_R(0.0), last = FB_R(0.0);
  for (int i = 0; i < iterations && status == FB_OK; i++) {
    fbi_kinetics here;

    /* Residual f - k */
    fbi_stage_advance(&w->stage, body, base, w->g, k);
    if (fbi_is_oriented(body, input)) {
      fb_quat_to_mat33(here.R, w->stage.quat);
    }
    status = fbi_rates(&w->rate, &here, body, &w->stage, input);
    if (status == FB_OK && i == iterations - 1 && !body->allow_long_step) {
      status = fbi_turn_check(at->V + 3, here.V + 3, dt);
    }
    fbi_state_advance(&w->rate, &w->rate, -FB_R(1.0), k, body->n);

    /* Correction */
    fbi_implicit_solve(&w->rate, w, body, at, &w->start);
    fbi_state_advance(k, k, FB_R(1.0), &w->rate, body->n);
    last = fbi_rate_size(&w->rate, body, w->g);
    first = i == 0 ? last : first;
  }
  return status == FB_OK && iterations > 1 ? fbi_stage_check(first, last, fbi_rate_size(k, body, w->g)) : status;
}

/* Velocity of a prescribed base at the midpoint of E11.7 in the axes of the start, for the first guess. */
static void fbi_base_guess(fb_real v[3], const fb_input *middle, fb_real g)
{
  fb_real own[4], R[9];
  fbi_turn_inverse(own, g, middle->w);
  fb_quat_to_mat33(R, own);
  fb_mat33_mul_vec3(v, R, middle->v);
}

/* [E11.7] Implicit midpoint, y += dt k with k = f(t + dt/2, y + dt/2 k).
   Source: textbook; conserves quadratic invariants, symmetric.  Cost: 1 + iterations evaluations, one LU.
   Fails: as E11.4.  Test: each_integrator_converges_at_its_order, midpoint_keeps_energy_and_momentum. */
FB_DEF fb_status fb_midpoint_step(const fb_body *body, fb_state *state, fb_implicit_work *work, const fb_input *middle,
                                  fb_real dt, int iterations)
{
  const fb_input *first = middle;
  fbi_kinetics at;
  fb_status status;
  FBI_REQUIRE(body && state && work, FB_ERR_NULL);
  FBI_REQUIRE(iterations >= 0 && iterations <= FBI_MAX_ITERATIONS, FB_ERR_VALUE);

  /* Iteration matrix at the start */
  if (fbi_is_following(body) && middle) {
    work->between = *middle;
    fbi_base_guess(work->between.v, middle, FB_R(0.5) * dt);
    first = &work->between;
  }
  status = fbi_implicit_start(work, &at, body, state, first, dt, FB_R(0.5) * dt);

  /* Stage k */
  if (status == FB_OK) {
    work->first = work->rate;
    fbi_implicit_solve(&work->first, work, body, &at, &work->start);
    status = fbi_stage_solve(work, &work->first, body, &at, &work->start, middle, iterations > 0 ? iterations : 2, dt);
  }
  if (status != FB_OK) {
    return status;
  }

  /* dt k */
  fbi_state_scale(&work->sum, dt, &work->first, body->n);
  return fbi_step_end(state, &work->sum, &work->start, body, middle, work->stage.quat);
}

/* Input interpolated at the fraction s; loads must be at the same nodes in the same axes. */
static fb_status fbi_input_between(fb_input *out, const fb_input *a, const fb_input *b, fb_real s)
{
  *out = *a;
  if (a->n_load != b->n_load) {
    return FB_ERR_VALUE;
  }

  /* Same nodes and axes? */
  for (int k = 0; k < a->n_load; k++) {
    if (a->load[k].node != b->load[k].node || a->load[k].axes != b->load[k].axes) {
      return FB_ERR_VALUE;
    }
  }

  /* Linear interpolation */
  for (int i = 0; i < 3; i++) {
    for (int k = 0; k < a->n_load; k++) {
      out->load[k].force[i] += s * (b->load[k].force[i] - a->load[k].force[i]);
      out->load[k].torque[i] += s * (b->load[k].torque[i] - a->load[k].torque[i]);
    }
    out->v[i] += s * (b->v[i] - a->v[i]);
    out->w[i] += s * (b->w[i] - a->w[i]);
    out->v_dot[i] += s * (b->v_dot[i] - a->v_dot[i]);
    out->w_dot[i] += s * (b->w_dot[i] - a->w_dot[i]);
  }
  return FB_OK;
}

/* [E11.34] Velocity v of a prescribed base at the first stage of E11.8, in its axes: interpolated in inertial axes,
   where a straight uniform motion has one velocity, with the attitudes that the integrator computes.
   Source: E11.8 of the attitude alone.  Cost: 250 flops.  Fails: never.
   Test: the_speed_of_a_prescribed_base_does_not_matter. */
static void fbi_base_between(fb_real v[3], const fb_state *start, const fb_input *a, const fb_input *stage,
                             const fb_input *b, fb_real c, fb_real dt)
{
  fb_real own[4], middle[4], end[4], rate[4], R[9], first[3], last[3];

  /* Attitudes at the stage and at the end, by E11.8 */
  fbi_turn_inverse(own, c * dt, stage->w);
  fb_quat_mul(middle, start->quat, own);
  fbi_quat_rate(rate, middle, stage->w);
  for (int i = 0; i < 4; i++) {
    rate[i] = start->quat[i] + (FB_R(1.0) - c) * dt * rate[i];
  }
  fbi_turn_inverse(own, c * dt, b->w);
  fb_quat_mul(end, rate, own);

  /* Velocities in inertial axes, interpolated */
  fb_quat_to_mat33(R, start->quat);
  fb_mat33_mul_vec3(first, R, a->v);
  fb_quat_to_mat33(R, end);
  fb_mat33_mul_vec3(last, R, b->v);
  for (int i = 0; i < 3; i++) {
    first[i] += c * (last[i] - first[i]);
  }
  fb_quat_to_mat33(R, middle);
  fb_mat33_mulT_vec3(v, R, first);
}

/* [E11.8] Two-stage SDIRK integrator of order 2, L-stable and stiffly accurate, c = 1 - 1/sqrt(2):
   k_1 = f(t + c dt, y + c dt k_1),  k_2 = f(t + dt, y + (1-c) dt k_1 + c dt k_2),  y <- its last stage.
   Source: [AL].  Cost: 1 + 2 iterations evaluations, one LU.
   Fails: as E11.4.  Test: each_integrator_converges_at_its_order, steps_may_be_a_thousand_periods_long. */
FB_DEF fb_status fb_sdirk_step(const fb_body *body, fb_state *state, fb_implicit_work *work, const fb_input *start,
                               const fb_input *end, fb_real dt, int iterations)
{
  const fb_real c = FB_R(0.29289321881345248);
  const int count = iterations > 0 ? iterations : 2;
  const fb_input *first = start;
  fbi_kinetics at;
  fb_status status;
  FBI_REQUIRE(body && state && work, FB_ERR_NULL);
  FBI_REQUIRE((start != NULL) == (end != NULL), FB_ERR_NULL);
  FBI_REQUIRE(iterations >= 0 && iterations <= FBI_MAX_ITERATIONS, FB_ERR_VALUE);

  /* Iteration matrix at the start, input at the first stage */
  status = fbi_implicit_start(work, &at, body, state, start, dt, c * dt);
  if (status == FB_OK && start != end) {
    status = fbi_input_between(&work->between, start, end, c);
    first = &work->between;
    if (fbi_is_following(body)) {
      fbi_base_between(work->between.v, &work->start, start, &work->between, end, c, dt);
    }
  }

  /* First stage */
  if (status == FB_OK) {
    work->first = work->rate;
    fbi_implicit_solve(&work->first, work, body, &at, &work->start);
    status = fbi_stage_solve(work, &work->first, body, &at, &work->start, first, count, dt);
  }

  /* Second stage */
  if (status == FB_OK) {
    fbi_state_scale(&work->sum, (FB_R(1.0) - c) * dt, &work->first, body->n);
    fbi_stage_advance(&work->base, body, &work->start, (FB_R(1.0) - c) * dt, &work->first);
    status = fbi_stage_solve(work, &work->first, body, &at, &work->base, end, count, dt);
  }
  if (status != FB_OK) {
    return status;
  }

  /* (1-c) dt k_1 + c dt k_2 */
  fbi_state_advance(&work->sum, &work->sum, c * dt, &work->first, body->n);
  return fbi_step_end(state, &work->sum, &work->start, body, end, NULL);
}

/* ---- exponential integrator */

/* [E11.11] Largest step of the exponential integrator: gyroscopic terms 2 |w|, increased by the recoil of a light base
   (squared), geometric stiffening by the quadratic displacement field, change of frequencies by the tension of a
   spinning beam, heavy damping; the largest of them times dt <= 1.
   Source: trials.  Fails: never.  Test: steps_within_the_limit_are_stable. */
FB_DEF fb_real fb_exponential_limit(const fb_body *body, fb_real spin, fb_real acceleration)
{
  FBI_REQUIRE(body, FB_R(0.0));
  const fb_real lightness = body->recoil * body->recoil - FB_R(1.0); /* 0: no recoil */
  const fb_real turning = (FB_R(2.0) * body->recoil + FB_R(15.0) * lightness) * FB_FABS(spin);
  const int heavy = body->limit_damping > FB_R(0.5) * FB_SQRT(body->limit_elastic);
  fb_real bound = fbi_larger(turning, fbi_stiffening(body, spin, acceleration));
#if FB_WITH_NONLINEAR_STRAIN
  bound = fbi_larger(bound, body->limit_tension * spin * spin);
#endif
  return fbi_step_limit(FB_R(1.0), fbi_larger(bound, heavy ? body->limit_damping : FB_R(0.0)));
}

#if FB_WITH_NONLINEAR_STRAIN
/* Membrane coordinates s = q + sign G(q), sign -1 for the inverse; slope: of q, the same as of s. */
static void fbi_membrane_shift(fb_real *q, fb_real slope[3][FBI_MAX_STRAINS], const fb_exponential *scheme,
                               const fb_body *body, fb_real sign)
{
  fb_real r[FBI_MAX_STRAINS];
  fbi_slopes_eval(slope, body, q);
  for (int g = 0; g < body->n_strain; g++) {
    r[g] = FB_R(0.5) * (slope[1][g] * slope[1][g] + slope[2][g] * slope[2][g]);
  }
  for (int k = 0; k < scheme->n_axial; k++) {
    q[scheme->axial[k]] += sign * fbi_dot(scheme->G + k * FBI_MAX_STRAINS, r, body->n_strain);
  }
}

/* h_g = sum_a G_ag pi_a */
static void fbi_membrane_loads(fb_real h[FBI_MAX_STRAINS], const fb_exponential *scheme, const fb_body *body,
                               const fb_real *pi)
{
  fbi_zero(h, body->n_strain);
  for (int k = 0; k < scheme->n_axial; k++) {
    fbi_row_sub(h, -pi[scheme->axial[k]], scheme->G + k * FBI_MAX_STRAINS, body->n_strain);
  }
}

/* x_b -= sum_g psi_b' (h u' + k v') over the transverse rows: G'^T pi, and its rate */
static void fbi_membrane_sub(fb_real *x, const fb_body *body, const fb_real *h, fb_real u[3][FBI_MAX_STRAINS],
                             const fb_real *k, fb_real v[3][FBI_MAX_STRAINS])
{
  fb_real f[3][FBI_MAX_STRAINS];
  for (int g = 0; g < body->n_strain; g++) {
    f[0][g] = FB_R(0.0);
    f[1][g] = h[g] * u[1][g] + k[g] * v[1][g];
    f[2][g] = h[g] * u[2][g] + k[g] * v[2][g];
  }
  fbi_slopes_sub(x, body, f);
}
#endif

/* Modal coordinates z: x in z.q, p in z.pi. */
static void fbi_modal_from(fb_state *z, const fb_exponential *scheme, const fb_body *body, fb_state *state)
{
  const int n = body->n;
#if FB_WITH_NONLINEAR_STRAIN
  if (scheme->n_axial > 0) {
    fb_real slope[3][FBI_MAX_STRAINS], h[FBI_MAX_STRAINS], none[FBI_MAX_STRAINS] = {0};
    fbi_membrane_loads(h, scheme, body, state->pi);
    fbi_membrane_shift(state->q, slope, scheme, body, FB_R(1.0));
    fbi_membrane_sub(state->pi, body, h, slope, none, slope);
  }
#endif
  fbi_frame_copy(z, state);
  for (int k = 0; k < n; k++) {
    z->q[k] = fbi_dot(scheme->MX + k * n, state->q, n);
    z->pi[k] = fbi_dot(scheme->X + k * n, state->pi, n);
  }
}

/* Inverse of fbi_modal_from. */
static void fbi_modal_to(fb_state *state, const fb_exponential *scheme, const fb_body *body, const fb_state *z)
{
  const int n = body->n;
  fbi_frame_copy(state, z);
  fbi_zero(state->q, n);
  fbi_zero(state->pi, n);
  for (int k = 0; k < n; k++) {
    fbi_row_sub(state->q, -z->q[k], scheme->X + k * n, n);
    fbi_row_sub(state->pi, -z->pi[k], scheme->MX + k * n, n);
  }
#if FB_WITH_NONLINEAR_STRAIN
  if (scheme->n_axial > 0) {
    fb_real slope[3][FBI_MAX_STRAINS], h[FBI_MAX_STRAINS], none[FBI_MAX_STRAINS] = {0};
    fbi_membrane_shift(state->q, slope, scheme, body, -FB_R(1.0));
    fbi_membrane_loads(h, scheme, body, state->pi);
    for (int g = 0; g < body->n_strain; g++) {
      h[g] = -h[g];
    }
    fbi_membrane_sub(state->pi, body, h, slope, none, slope);
  }
#endif
}

/* Rates of z minus the linear elastic part: N = (X M s_dot - p, X sigma_dot + omega^2 x). */
static fb_status fbi_modal_rates(fb_state *N, fbi_kinetics *k, fb_exponential_work *w, const fb_exponential *scheme,
                                 const fb_body *body, const fb_state *z, const fb_input *input)
{
  const int n = body->n;
  fb_status status = fbi_input_check(body, input);

  /* Rates of the body */
  fbi_modal_to(&w->at, scheme, body, z);
  if (fbi_is_oriented(body, input)) {
    fb_quat_to_mat33(k->R, z->quat);
  }
  status = status == FB_OK ? fbi_rates(&w->rate, k, body, &w->at, input) : status;
  if (status != FB_OK) {
    return status;
  }
#if FB_WITH_NONLINEAR_STRAIN
  if (scheme->n_axial > 0) {
    fb_real rate[3][FBI_MAX_STRAINS], h[FBI_MAX_STRAINS], h_dot[FBI_MAX_STRAINS], r[FBI_MAX_STRAINS] = {0};
    fbi_slopes_eval(rate, body, w->rate.q);
    fbi_membrane_loads(h, scheme, body, w->at.pi);
    fbi_membrane_loads(h_dot, scheme, body, w->rate.pi);
    for (int g = 0; g < body->n_strain; g++) {
      r[g] = k->slope[1][g] * rate[1][g] + k->slope[2][g] * rate[2][g];
    }
    for (int a = 0; a < scheme->n_axial; a++) {
      w->rate.q[scheme->axial[a]] += fbi_dot(scheme->G + a * FBI_MAX_STRAINS, r, body->n_strain);
    }
    fbi_membrane_sub(w->rate.pi, body, h_dot, k->slope, h, rate);
  }
#endif

  /* Modal coordinates, less L z */
  fbi_frame_copy(N, &w->rate);
  for (int i = 0; i < n; i++) {
    N->q[i] = fbi_dot(scheme->MX + i * n, w->rate.q, n) - z->pi[i];
    N->pi[i] = fbi_dot(scheme->X + i * n, w->rate.pi, n) + scheme->omega2[i] * z->q[i];
  }
  return FB_OK;
}

/* y += s phi_j(h L) v: c_j + h L c_(j+1) with L = [0 1; -omega^2 0] for modes, 1/j! for the rest. */
static void fbi_phi_add(fb_state *y, fb_real s, const fb_real c[5][FB_MAX_MODES], int j, const fb_exponential *scheme,
                        fb_real h, const fb_state *v, int n)
{
  const fb_real rest = s * (j < 2 ? FB_R(1.0) : j == 2 ? FB_R(0.5) : FB_R(1.0) / FB_R(6.0));
  fbi_frame_advance(y, y, rest, v);
  for (int k = 0; k < n; k++) {
    y->q[k] += s * (c[j][k] * v->q[k] + h * c[j + 1][k] * v->pi[k]);
    y->pi[k] += s * (c[j][k] * v->pi[k] - h * scheme->omega2[k] * c[j + 1][k] * v->q[k]);
  }
}

/* y += (e^(h L) - 1) v for modes, with c_0 - 1 = -(omega h)^2 c_2, free of cancellation for short steps. */
static void fbi_phi_increment(fb_state *y, const fb_exponential *scheme, const fb_state *v, int n)
{
  const fb_real h = scheme->dt;
  for (int k = 0; k < n; k++) {
    const fb_real c1 = h * scheme->full[1][k], turn = -scheme->omega2[k] * h * h * scheme->full[2][k];
    y->q[k] += turn * v->q[k] + c1 * v->pi[k];
    y->pi[k] += turn * v->pi[k] - scheme->omega2[k] * c1 * v->q[k];
  }
}

/* Transforms the increments of a step from modal coordinates (work->full) to work->at; with membrane coordinates the
   map is nonlinear, and increments are differences of states. */
static void fbi_modal_increments(fb_exponential_work *w, const fb_exponential *scheme, const fb_body *body,
                                 const fb_state *state)
{
  if (scheme->n_axial == 0) {
    fbi_modal_to(&w->at, scheme, body, &w->full);
    return;
  }
  fbi_state_advance(&w->half, &w->z, FB_R(1.0), &w->full, body->n);
  fbi_modal_to(&w->at, scheme, body, &w->half);
  fbi_frame_copy(&w->at, &w->full);
  fbi_row_sub(w->at.q, FB_R(1.0), state->q, body->n);
  fbi_row_sub(w->at.pi, FB_R(1.0), state->pi, body->n);
}

FB_DEF fb_status fb_exponential_check(const fb_exponential *scheme, const fb_body *body)
{
  int n, sound;
  FBI_REQUIRE(scheme && body, FB_ERR_NULL);

  /* Capacities */
  n = body->n;
  if (!fbi_is_within(n, FB_MAX_MODES) || !fbi_is_within(scheme->n_axial, n)) {
    return FB_ERR_CAPACITY;
  }
#if FB_WITH_NONLINEAR_STRAIN
  if (!fbi_is_within(body->n_strain, FBI_MAX_STRAINS)) {
    return FB_ERR_CAPACITY;
  }
#endif

  /* Values */
  sound = scheme->dt > FB_R(0.0) && scheme->dt < FB_HUGE && fbi_is_finite(scheme->X, n * n) &&
          fbi_is_finite(scheme->MX, n * n) && fbi_is_finite(scheme->omega2, n);
  for (int k = 0; sound && k < 5; k++) {
    sound = fbi_is_finite(scheme->half[k], n) && fbi_is_finite(scheme->full[k], n);
  }
  for (int k = 0; sound && k < scheme->n_axial; k++) {
    sound = fbi_is_within(scheme->axial[k], n - 1);
  }
#if FB_WITH_NONLINEAR_STRAIN
  for (int k = 0; sound && k < scheme->n_axial; k++) {
    sound = fbi_is_finite(scheme->G + k * FBI_MAX_STRAINS, body->n_strain);
  }
#endif
  return sound ? FB_OK : FB_ERR_VALUE;
}

static fb_status fbi_exponential_limited(const fb_body *body, const fbi_kinetics *k, const fb_input *input, fb_real h)
{
  fb_real spin, acceleration;
  if (body->allow_long_step) {
    return FB_OK;
  }
  fbi_step_conditions(&spin, &acceleration, body, k, input);
  return h <= fb_exponential_limit(body, spin, acceleration)
             ? FB_OK
             : FBI_REFUSE_AT(FB_ERR_STEP, FBI_WORD_SPIN, -1, h, fb_exponential_limit(body, spin, acceleration), spin);
}

/* Stages of E11.10 after the first: z_2, z_3, z_4 and their N; w->full = (e^(hL) - 1) z + h phi_1(hL) N_1. */
static fb_status fbi_exponential_stages(fb_exponential_work *w, fbi_kinetics *k, const fb_exponential *scheme,
                                        const fb_body *body, const fb_input *middle, const fb_input *end)
{
  const int n = body->n;
  const fb_real h = scheme->dt;
  fb_state *z = &w->z, *N = w->N, *sum = &w->sum;
  fb_status status;

  /* z_2, N_2 */
  memset(&w->half, 0, sizeof w->half);
  fbi_phi_add(&w->half, FB_R(1.0), scheme->half, 0, scheme, FB_R(0.5) * h, z, n);
  fbi_phi_add(&w->half, FB_R(0.5) * h, scheme->half, 1, scheme, FB_R(0.5) * h, &N[0], n);
  status = fbi_modal_rates(&N[1], k, w, scheme, body, &w->half, middle);

  /* z_3, N_3 */
  if (status == FB_OK) {
    fbi_state_advance(sum, &N[1], -FB_R(1.0), &N[0], n);
    fbi_phi_add(&w->half, h, scheme->half, 2, scheme, FB_R(0.5) * h, sum, n);
    status = fbi_modal_rates(&N[2], k, w, scheme, body, &w->half, middle);
  }

  /* z_4, N_4 */
  if (status == FB_OK) {
    memset(&w->full, 0, sizeof w->full);
    fbi_phi_increment(&w->full, scheme, z, n);
    fbi_phi_add(&w->full, h, scheme->full, 1, scheme, h, &N[0], n);
    fbi_state_advance(sum, &N[2], -FB_R(1.0), &N[0], n);
    fbi_state_advance(&w->half, z, FB_R(1.0), &w->full, n);
    fbi_phi_add(&w->half, FB_R(2.0) * h, scheme->full, 2, scheme, h, sum, n);
    status = fbi_modal_rates(&N[3], k, w, scheme, body, &w->half, end);
  }
  return status;
}

/* Terms of E11.10 in all four N, added to w->full: h phi_2 (-3 N_1 + 2 N_2 + 2 N_3 - N_4) and
   4h phi_3 (N_1 - N_2 - N_3 + N_4). */
static void fbi_exponential_sum(fb_exponential_work *w, const fb_exponential *scheme, int n)
{
  const fb_real h = scheme->dt;
  fb_state *N = w->N, *sum = &w->sum;
  fbi_state_advance(&N[1], &N[1], FB_R(1.0), &N[2], n); /* N_2 + N_3 */
  fbi_state_advance(sum, &N[0], -FB_R(1.0), &N[1], n);
  fbi_state_advance(sum, sum, FB_R(1.0), &N[3], n); /* N_1 - N_2 - N_3 + N_4 */
  fbi_phi_add(&w->full, FB_R(4.0) * h, scheme->full, 3, scheme, h, sum, n);
  fbi_state_advance(sum, &N[1], -FB_R(1.0), sum, n); /* -N_1 + 2 N_2 + 2 N_3 - N_4 */
  fbi_state_advance(sum, sum, -FB_R(2.0), &N[0], n);
  fbi_phi_add(&w->full, h, scheme->full, 2, scheme, h, sum, n);
}

/* [E11.10] Exponential Runge-Kutta integrator of order 4 for z' = L z + N(t, z), stages at 0, 1/2, 1/2, 1:
   z_2 = e^(hL/2) z + h/2 phi_1(hL/2) N_1,  z_3 = z_2 + h phi_2(hL/2) (N_2 - N_1),
   z_4 = e^(hL) z + h phi_1(hL) N_1 + 2h phi_2(hL) (N_3 - N_1),
   z <- e^(hL) z + h phi_1 N_1 + h phi_2 (-3 N_1 + 2 N_2 + 2 N_3 - N_4) + 4h phi_3 (N_1 - N_2 - N_3 + N_4).
   For L = 0 this is the classical Runge-Kutta integrator.
   Source: [KR].  Cost: 4 evaluations, 16 n^2 flops each.  Fails: as the rates.
   Test: each_integrator_converges_at_its_order, the_exponential_integrator_is_exact_for_linear_bodies. */
FB_DEF fb_status fb_exponential_step(const fb_body *body, const fb_exponential *scheme, fb_state *state,
                                     fb_exponential_work *work, const fb_input *start, const fb_input *middle,
                                     const fb_input *end)
{
  fbi_kinetics k;
  fb_real turn[3];
  fb_status status;
  FBI_REQUIRE(body && scheme && state && work, FB_ERR_NULL);

  /* N_1, step limit */
  fbi_state_enter(&work->start, k.R, body, state);
  fbi_frame_copy(&work->at, &work->start);
  fbi_elastic_copy(&work->at, &work->start, body->n);
  fbi_modal_from(&work->z, scheme, body, &work->at);
  status = fbi_modal_rates(&work->N[0], &k, work, scheme, body, &work->z, start);
  status = status == FB_OK ? fbi_exponential_limited(body, &k, start, scheme->dt) : status;
  fbi_vec3_copy(turn, k.V + 3);

  /* z_2, z_3, z_4 and their N; increments, in z and in the state */
  status = status == FB_OK ? fbi_exponential_stages(work, &k, scheme, body, middle, end) : status;
  status = status == FB_OK && !body->allow_long_step ? fbi_turn_check(turn, k.V + 3, scheme->dt) : status;
  if (status != FB_OK) {
    return status;
  }
  fbi_exponential_sum(work, scheme, body->n);
  fbi_modal_increments(work, scheme, body, state);
  return fbi_step_end(state, &work->at, &work->start, body, end, NULL);
}

#if FB_WITH_SYSTEM
/* ---- systems */

/* y = a + s b for the coordinates and momenta of a joint; the quaternion is not normalized. */
static void fbi_link_advance(fb_link_state *y, const fb_link_state *a, fb_real s, const fb_link_state *b,
                             const fb_joint *joint)
{
  if (joint->kind == FB_JOINT_FREE) {
    fbi_vec4_advance(y->quat, a->quat, s, b->quat);
    fbi_vec6_advance(y->p, a->p, s, b->p);
    fbi_vec3_advance(y->lost_x, a->lost_x, s, b->lost_x);
  } else if (joint->kind == FB_JOINT_SPHERICAL) {
    fbi_vec4_advance(y->quat, a->quat, s, b->quat);
    fbi_vec3_advance(y->p, a->p, s, b->p);
  } else {
    for (int i = 0; i < joint->n_axis; i++) {
      y->x[i] = a->x[i] + s * b->x[i];
      y->p[i] = a->p[i] + s * b->p[i];
    }
  }
}

/* out = state + s rate; out may be state */
static void fbi_system_advance(fb_system_state *out, const fb_system_state *state, fb_real s,
                               const fb_system_state *rate, const fb_system *system, const fb_system_work *w,
                               const fb_body *body)
{
  out->motor_work = state->motor_work + s * rate->motor_work;
  for (int k = 0; k < system->n_body; k++) {
    const int n = fbi_model(system, body, k)->n;
    const fb_link_state *a = &state->link[k], *b = &rate->link[k];
    fb_link_state *y = &out->link[k];
    fbi_link_advance(y, a, s, b, fbi_link_joint(system, w, k));
    for (int i = 0; i < n; i++) {
      y->q[i] = a->q[i] + s * b->q[i];
      y->pi[i] = a->pi[i] + s * b->pi[i];
    }
  }
}

/* Copies the links and the motor work of a state, not the modes of its axes. */
static void fbi_links_copy(fb_system_state *out, const fb_system_state *state, const fb_system *system)
{
  for (int k = 0; k < system->n_body; k++) {
    out->link[k] = state->link[k];
  }
  out->motor_work = state->motor_work;
}

/* A rate of zero. */
static void fbi_system_clear(fb_system_state *rate, const fb_system *system, const fb_body *body)
{
  rate->motor_work = FB_R(0.0);
  for (int k = 0; k < system->n_body; k++) {
    fb_link_state *x = &rate->link[k];
    fbi_vec3_zero(x->x);
    fbi_vec3_zero(x->lost_x);
    fbi_zero(x->quat, 4);
    fbi_zero(x->p, 6);
    fbi_zero(x->q, fbi_model(system, body, k)->n);
    fbi_zero(x->pi, fbi_model(system, body, k)->n);
  }
}

/* E11.26 for all bodies. begin: stores the angular velocities of the start. */
static fb_status fbi_turns_check(fb_system_work *w, const fb_system *system, fb_real dt, int begin)
{
  fb_status status = FB_OK;
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *L = &w->link[k];
    if (begin) {
      fbi_vec3_copy(L->turn, L->V + 3);
    }
    if (status == FB_OK) {
      status = fbi_turn_check(L->turn, L->V + 3, dt);
      FBI_DETAIL_INDEX(status, k);
    }
  }
  return status;
}

/* Bound of the highest frequency of a system: E8.8 with the springs and modes of the whole system. */
static fb_real fbi_system_frequency(const fb_system *system, fb_real spin, fb_real stiffening)
{
  const fb_real g = spin + FB_R(0.5) * (system->limit_damping + system->limit_kept_damping);
  return g + FB_SQRT(g * g + system->limit_elastic + system->limit_kept_elastic + stiffening);
}

/* [E11.15] Largest step of rk4 for a system: the frequency bound of E8.8 with the springs and modes of the whole
   system, undeformed at zero joint coordinates, the fastest spin and the largest geometric stiffening of the bodies.
   Source: E8.8, E11.1.  Fails: never.  Test: system_steps_beyond_the_limit_are_refused. */
FB_DEF fb_real fb_system_rk4_limit(const fb_system *system, const fb_body *body, fb_real spin, fb_real acceleration)
{
  FBI_REQUIRE(system && body, FB_R(0.0));
  fb_real stiff = FB_R(0.0);
  for (int k = 0; k < system->n_body; k++) {
    const fb_body *model = fbi_model(system, body, k);
    stiff = fbi_larger(stiff, model->limit_spin * spin * spin + model->limit_acceleration * FB_FABS(acceleration));
  }
  return fbi_step_limit(FBI_RK4_RADIUS, fbi_system_frequency(system, FB_FABS(spin), stiff));
}

/* Fastest spin of the bodies and largest geometric stiffening k [1/s^2]; the acceleration of O is estimated from the
   spin of the bodies between it and the root, and from the force on the tree. */
static void fbi_system_conditions(fb_real *spin, fb_real *stiffening, fb_system_work *w, const fb_system *system)
{
  *spin = *stiffening = FB_R(0.0);
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *L = &w->link[k];
    const fb_body *model = w->link[k].model;
    const fbi_link_work *parent = L->parent;
    L->spin = fbi_vec3_norm(L->V + 3);
    if (parent) {
      L->acceleration = parent->acceleration + parent->spin * parent->spin * fbi_vec3_norm(L->s);
    } else {
      L->acceleration = model->mass > FB_R(0.0) ? fbi_vec3_norm(L->F) / model->mass : FB_R(0.0);
    }
    *spin = fbi_larger(*spin, L->spin);
    *stiffening =
        fbi_larger(*stiffening, model->limit_spin * L->spin * L->spin + model->limit_acceleration * L->acceleration);
  }
}

#if FB_WITH_DETAIL
/* FB_ERR_STEP with what bounds the step most and the fastest spin: a body's spin, stiffening or modes, a joint's spring
   or damper against what hangs on it (D of the articulated inertia). all: rk4, bounded by modes and joints of the tree,
   too. */
static fb_status fbi_refuse_step(const fb_system_work *w, const fb_system *system, int all, fb_real dt, fb_real limit,
                                 const char *function)
{
  const char *what = "";
  fb_real most = -FB_R(1.0), spin = FB_R(0.0), own[5];
  int index = -1;
  for (int j = 0; j < system->n_body + system->n_loop; j++) {
    static const char *const text[5] = {"body: dt [s] for its spin, with the fastest spin [rad/s], at most",
                                        "body: dt [s] for its modes, with the fastest spin [rad/s], at most",
                                        "body: dt [s] for its modal damping, with the fastest spin [rad/s], at most",
                                        "joint: dt [s] for its spring, with the fastest spin [rad/s], at most",
                                        "joint: dt [s] for its damper, with the fastest spin [rad/s], at most"};
    const fb_joint *joint = &system->joint[j];
    const int kept = fbi_is_kept(system, w, j);
    fbi_zero(own, 5);

    /* The body */
    if (j < system->n_body) {
      const fbi_link_work *L = &w->link[j];
      spin = fbi_larger(spin, L->spin);
      own[0] = (all ? FB_R(2.0) : FB_R(10.0)) * L->spin;
      own[1] = FB_SQRT(L->model->limit_spin * L->spin * L->spin + L->model->limit_acceleration * L->acceleration +
                       (all ? L->model->limit_elastic : FB_R(0.0)));
      own[2] = all ? L->model->limit_damping : FB_R(0.0);
    }

    /* Its joint, or one that constraint rows enforce */
    for (int i = 0; i < joint->n_axis && i < 3 && joint->kind != FB_JOINT_FREE; i++) {
      const int tree = all && !kept && w->link[j].mode[i] == FB_AXIS_FREE;
      const fb_real stiff = kept   ? system->limit_kept_elastic
                            : tree ? joint->stiffness[i] * w->link[j].D[i]
                                   : FB_R(0.0);
      const fb_real damp = kept ? system->limit_kept_damping : tree ? joint->damping[i] * w->link[j].D[i] : FB_R(0.0);
      own[3] = joint->stiffness[i] > FB_R(0.0) ? fbi_larger(own[3], FB_SQRT(stiff)) : own[3];
      own[4] = joint->damping[i] > FB_R(0.0) ? fbi_larger(own[4], damp) : own[4];
    }
    for (int i = 0; i < 5; i++) {
      what = own[i] > most ? text[i] : what;
      index = own[i] > most ? j : index;
      most = fbi_larger(most, own[i]);
    }
  }
  return fbi_refuse(FB_ERR_STEP, function, what, index, dt, limit, spin);
}
#define FBI_REFUSE_STEP(w, system, all, dt, limit) fbi_refuse_step(w, system, all, dt, limit, __func__)
#else
#define FBI_REFUSE_STEP(w, system, all, dt, limit) (FB_ERR_STEP)
#endif

#if FB_SINGLE
#define FBI_ADD(x, d, what, n) FBI_SUM(d, x, what, n), FBI_TAKE(x, d, what, n)
#else
#define FBI_ADD(x, d, what, n) fbi_row_sub((x)->what, -FB_R(1.0), (d)->what, n)
#endif

/* Positions += increment by E11.22, quaternions normalized; the position of a free joint is relative to the frame of
   its tree. FB_ERR_STEP: a rotation so large that the attitude is lost to round-off. */
static fb_status fbi_link_move(fb_link_state *x, fb_link_state *increment, const fb_joint *joint, int n)
{
  fb_status status = FB_OK;

  /* Attitude */
  if (fbi_is_ball(joint->kind)) {
    status = fbi_quat_increment(increment->quat, x->quat);
    FBI_ADD(x, increment, quat, 4);
    status = status == FB_OK && !fbi_quat_is_unit(x->quat)
                 ? FBI_REFUSE(FB_ERR_STEP, FBI_WORD_LOST, -1, FB_R(0.0), FB_R(0.0))
                 : status;
  }

  /* Position, joint coordinates, modes */
  if (joint->kind == FB_JOINT_FREE) {
    fbi_vec3_add(x->lost_x, FB_R(1.0), increment->lost_x);
  } else if (joint->kind != FB_JOINT_SPHERICAL) {
    FBI_ADD(x, increment, x, joint->n_axis);
  }
  if (n > 0) {
    FBI_ADD(x, increment, q, n);
    fbi_flush(x->q, n, FB_TINY);
  }
  return status;
}

/* Momenta += increment, small values flushed. */
static void fbi_link_push(fb_link_state *x, fb_link_state *increment, const fb_joint *joint, int n)
{
  FBI_ADD(x, increment, p, joint->n_axis);
  fbi_flush(x->p, joint->n_axis, FBI_FAINT);
  if (n > 0) {
    FBI_ADD(x, increment, pi, n);
    fbi_flush(x->pi, n, FB_TINY);
  }
}

static void fbi_links_push(fb_system_state *next, fb_system_work *w, const fb_system *system)
{
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_push(&next->link[k], &w->sum.link[k], w->link[k].joint, w->link[k].model->n);
  }
}

/* Is link k a free root whose body angular momentum is integrated too (E11.27)? */
static int fbi_owns(const fb_system *system, const fb_system_state *modes, int k)
{
  return system->joint[k].kind == FB_JOINT_FREE && modes->mode[k][0] == FB_AXIS_FREE;
}

/* Start of a step of free roots without constraints: angular momentum in body axes. */
static void fbi_own_begin(fb_system_work *w, const fb_system *system, const fb_system_state *state)
{
  w->owns = 1;
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *L = &w->link[k];
    if (system->joint[k].kind == FB_JOINT_FREE) {
      fb_real R[9];
      fb_quat_to_mat33(R, state->link[k].quat);
      fb_mat33_mulT_vec3(L->own_start, R, state->link[k].p + 3);
      fbi_vec3_copy(L->own, L->own_start);
      fbi_vec3_zero(L->own_sum);
    }
  }
}

/* [E11.27] Stage of the angular momentum h of a free root in body axes: h_dot = R^T L_dot - w x h; weight: in the sum
   of increments, ahead: of the next stage. With L in inertial axes alone an attitude error would appear as spin about a
   thin axis, magnified by I_t/I_x.
   Source: Euler's equations.  Cost: 40 flops a root.  Test: thin_tubes_keep_calm. */
static void fbi_own_stage(fbi_link_work *L, const fb_link_state *rate, fb_real weight, fb_real ahead)
{
  fb_real h_dot[3];
  fb_mat33_mulT_vec3(h_dot, L->k.R, rate->p + 3);
  fbi_vec3_add_cross(h_dot, L->own, L->V + 3);
  fbi_vec3_add(L->own_sum, weight, h_dot);
  fbi_vec3_copy(L->own, L->own_start);
  fbi_vec3_add(L->own, ahead, h_dot);
}

/* [E11.28] Corrects the attitude of a free root by the smallest rotation that takes R h to L, both about the mass
   center (E11.29): L is exact, h is exact about thin axes. increment: of the step; half the rotation vector times the
   attitude is added to its quaternion.
   Source: L = R h.  Cost: 120 flops a root.  Test: thin_tubes_keep_calm. */
static void fbi_own_end(fb_link_state *increment, const fbi_link_work *L, const fb_link_state *x)
{
  fb_real quat[4], R[9], a[3], b[3], moment[3], P[3];

  /* Attitude after the step */
  for (int i = 0; i < 4; i++) {
    quat[i] = x->quat[i] + increment->quat[i];
  }
  if (fb_quat_normalize(quat) != FB_OK || !(L->bulk > FB_R(0.0))) {
    return;
  }

  /* R h in a and L in b, moved to the mass center */
  fb_quat_to_mat33(R, quat);
  fb_mat33_mul_vec3(moment, R, L->first);
  for (int i = 0; i < 3; i++) {
    moment[i] /= L->bulk;
    P[i] = x->p[i] + increment->p[i];
    b[i] = L->own_start[i] + L->own_sum[i];
  }
  fb_mat33_mul_vec3(a, R, b);
  for (int i = 0; i < 3; i++) {
    b[i] = x->p[3 + i] + increment->p[3 + i];
  }
  fbi_vec3_add_cross(a, P, moment);
  fbi_vec3_add_cross(b, P, moment);

  /* Correction */
  fbi_attitude_onto(increment->quat, quat, a, b, fbi_vec3_norm(increment->p + 3));
}

/* Adds s times the momenta P of a stage, x + g rate, to their time integral in the frames. */
static void fbi_flight_add(fb_system_work *w, const fb_system *system, const fb_system_state *x, fb_real g,
                           const fb_system_state *rate, fb_real s)
{
  for (int k = 0; k < system->n_body; k++) {
    fb_real *glide = w->link[w->link[k].root].glide;
    if (w->link[k].joint->kind == FB_JOINT_FREE) {
      fbi_vec3_add(glide, s, x->link[k].p);
      fbi_vec3_add(glide, s * g, rate->link[k].p);
    }
  }
}

/* [E11.23] End of a step of free-flying trees: O is placed so that the mass center moves by the momentum, m c + P dt,
   which conserves the angular momentum about the inertial origin; then it moves with the frame, u dt, and the frames
   get their new velocities.
   Source: momentum of the whole.  Cost: 60 flops a body.  Test: flight_speed_changes_nothing,
   fast_systems_keep_their_angular_momentum. */
static void fbi_flight_end(fb_system_state *next, fb_system_work *w, const fb_system *system, fb_real dt)
{
  fbi_centers_lead(next, w, system);
  for (int k = 0; k < system->n_body; k++) {
    fb_link_state *x = &next->link[k];
    if (w->link[k].joint->kind == FB_JOINT_FREE) {
      fb_real step[3];
      for (int i = 0; i < 3; i++) {
        step[i] = dt * w->link[w->link[k].root].frame[i];
        x->lost_x[i] += dt * x->lost_u[i];
      }
      fbi_keep(x->x, x->lost_x, step, 3);
    }
  }
  fbi_frames_set(next, w, system);
}

/* Adds weight times the rates of a stage to the increments of the step and sets the next stage to start + ahead rates
   (last: no next stage). */
static void fbi_rk4_take(fb_system_work *w, const fb_system *system, const fb_system_state *at,
                         const fb_system_state *start, fb_real weight, fb_real ahead, int last)
{
  w->sum.motor_work += weight * w->rate.motor_work;
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *L = &w->link[k];
    const fb_link_state *rate = &w->rate.link[k], *from = &start->link[k];
    fb_link_state *sum = &w->sum.link[k], *next = &w->stage.link[k];
    const int n = L->model->n, free = L->joint->kind == FB_JOINT_FREE;

    /* Free root: integral of P, angular momentum in body axes */
    if (free) {
      fbi_vec3_add(w->link[L->root].glide, weight, at->link[k].p);
    }
    if (free && w->owns && L->mode[0] == FB_AXIS_FREE) {
      fbi_own_stage(L, rate, weight, ahead);
    }

    /* Joint coordinates and momenta, modes */
    fbi_link_advance(sum, sum, weight, rate, L->joint);
    if (!last) {
      fbi_link_advance(next, from, ahead, rate, L->joint);
    }
    for (int i = 0; i < n; i++) {
      sum->q[i] += weight * rate->q[i];
      sum->pi[i] += weight * rate->pi[i];
      next->q[i] = from->q[i] + ahead * rate->q[i];
      next->pi[i] = from->pi[i] + ahead * rate->pi[i];
    }
  }
}

/* Projects positions and velocities onto the constraints. */
static fb_status fbi_rows_end(fb_system_state *next, fb_system_work *w, const fb_system *system, const fb_body *body,
                              const fb_system_state *state, const fb_system_input *input)
{
  fb_real miss;
  int worst;
  fb_status status = fbi_positions_close(&miss, &worst, w, system, body, next, state, input);
  status = status == FB_OK ? fbi_momenta_close(w, system, body, next, state, input) : status;
  miss = status == FB_OK ? fbi_rows_miss(&worst, w, system) : FB_R(0.0);
  if (status == FB_OK &&
      !(miss <= (FB_SINGLE ? FB_R(1e-3) : FB_R(1e-5)))) { /* contradictory constraints, or far too long a step */
    w->joint = worst;
    return FB_ERR_CONTRADICTION;
  }
  return status;
}

/* Common end of every step: sums the increments (work.sum), sets prescribed coordinates, projects onto the constraints,
   updates the frames of free-flying trees, checks the range of the model. */
static fb_status fbi_system_end(fb_system_state *state, fb_system_work *w, const fb_system *system, const fb_body *body,
                                const fb_system_input *input, fb_real dt)
{
  fb_system_state *const next = &w->stage;
  const int flies = fbi_flies(system, w), rows = fbi_has_rows(system, w, input);
  fb_status status = FB_OK;

  /* Attitude of free roots (E11.28), positions */
  w->clock = dt;
  fbi_links_copy(next, state, system);
  next->motor_work += w->sum.motor_work;
  for (int k = 0; k < system->n_body && w->owns; k++) {
    if (fbi_owns(system, state, k)) {
      fbi_own_end(&w->sum.link[k], &w->link[k], &next->link[k]);
    }
  }
  w->owns = 0;
  for (int k = 0; k < system->n_body && status == FB_OK; k++) {
    status = fbi_link_move(&next->link[k], &w->sum.link[k], w->link[k].joint, w->link[k].model->n);
    FBI_DETAIL_INDEX(status, k);
  }
  if (status != FB_OK) {
    return status;
  }

  /* Prescribed coordinates, momenta */
  fbi_prescribe(next, system, w, state, input);
  if (flies && !rows) {
    fbi_links_place(w, system, body, next, state);
    fbi_frames_take(w, system, next, &w->sum, state, input);
  }
  fbi_links_push(next, w, system);

  /* Constraints */
  if (rows) {
    status = fbi_rows_end(next, w, system, body, state, input);
  }

  /* Frames of free-flying trees */
  if (flies && rows && status == FB_OK) {
    fbi_frames_take(w, system, next, NULL, state, input);
  }
  if (flies && status == FB_OK) {
    fbi_flight_end(next, w, system, dt);
  }

  /* Range, then commit */
  status = status == FB_OK ? fbi_system_range(system, body, next) : status;
  if (status == FB_OK) {
    fbi_links_copy(state, next, system);
  }
  return status;
}

static fb_status fbi_system_step_check(const fb_system *system, const fb_body *body, const fb_system_input *input,
                                       fb_real dt)
{
  return dt > FB_R(0.0) && dt < FB_HUGE ? fbi_system_input_check(system, body, input)
                                        : FBI_REFUSE(FB_ERR_VALUE, FBI_WORD_DT, -1, dt, FB_R(0.0));
}

/* Does a prescribed value stay as it is over a step while its rates at both ends go the same way? One input that is
   held over the step does not tell. */
static FBI_NOINLINE fb_status fbi_drives_check(fb_system_work *w, const fb_system *system, const fb_system_state *state,
                                               const fb_system_input *start, const fb_system_input *end)
{
  for (int j = 0; j < system->n_body + system->n_loop && start && end && start != end; j++) {
    const fb_drive *const a = &start->drive[j], *const b = &end->drive[j];
    const int axes = fbi_is_ball(system->joint[j].kind) ? 0 : system->joint[j].n_axis;
    for (int i = 0; i < axes; i++) {
      if (state->mode[j][i] == FB_AXIS_PRESCRIBED && a->value[i] == b->value[i] &&
          a->rate[i] * b->rate[i] > FB_R(0.0)) {
        w->joint = j;
        return FBI_REFUSE_AT(FB_ERR_CONTRADICTION,
                             "joint: rate of a prescribed axis whose value does not change in the step, equal to", j,
                             b->rate[i], FB_R(0.0), (fb_real)i);
      }
    }
  }
  return FB_OK;
}

/* [E11.12] Classical Runge-Kutta on a system. Constraint impulses start at zero in each step, so that an ordinary
   differential equation is integrated; after the step positions and velocities are projected onto the constraints.
   Source: textbook, E9.15, E9.17.  Cost: 4 evaluations, with constraints 2 solutions more.
   Test: systems_converge_with_the_order_of_the_integrator, redundant_loops_are_accepted. */
FB_DEF fb_status fb_system_rk4_step(const fb_system *system, const fb_body *body, fb_system_state *state,
                                    fb_system_work *work, const fb_system_input *start, const fb_system_input *middle,
                                    const fb_system_input *end, fb_real dt)
{
  static const fb_real node[3] = {FB_R(0.5), FB_R(0.5), FB_R(1.0)};
  static const fb_real weight[4] = {FB_R(1.0) / FB_R(6.0), FB_R(1.0) / FB_R(3.0), FB_R(1.0) / FB_R(3.0),
                                    FB_R(1.0) / FB_R(6.0)};
  const fb_system_input *input[4];
  fb_status status = FB_OK;
  int flies;
  FBI_REQUIRE(system && body && state && work, FB_ERR_NULL);
  fbi_system_enter(work, system);
  flies = fbi_flies(system, work);

  /* Inputs of the four stages; E11.27 for free flight without constraints */
  input[0] = start;
  input[1] = input[2] = middle;
  input[3] = end;
  if (flies && !fbi_has_rows(system, work, start) && !fbi_has_rows(system, work, middle) &&
      !fbi_has_rows(system, work, end)) {
    fbi_own_begin(work, system, state);
  }

  /* Stages */
  status = fbi_drives_check(work, system, state, start, end);
  fbi_system_clear(&work->sum, system, body);
  for (int stage = 0; stage < 4 && status == FB_OK; stage++) {
    const fb_system_state *at = stage == 0 ? state : &work->stage;

    /* Rates */
    status = fbi_system_step_check(system, body, input[stage], dt);
    if (status == FB_OK && stage > 0) {
      fbi_prescribe(&work->stage, system, work, state, input[stage]);
      work->clock = dt * node[stage - 1];
    }
    status = status == FB_OK ? fbi_system_rates(work, system, body, &work->rate, at, state, input[stage]) : status;

    /* Step limit at the start, rotation at every stage */
    if (status == FB_OK && stage == 0 && !system->allow_long_step) {
      fb_real spin, stiff;
      fbi_system_conditions(&spin, &stiff, work, system);
      status = dt <= fbi_step_limit(FBI_RK4_RADIUS, fbi_system_frequency(system, spin, stiff))
                   ? FB_OK
                   : FBI_REFUSE_STEP(work, system, 1, dt,
                                     fbi_step_limit(FBI_RK4_RADIUS, fbi_system_frequency(system, spin, stiff)));
    }
    if (status == FB_OK && !system->allow_long_step) {
      status = fbi_turns_check(work, system, dt, stage == 0);
    }

    /* Weighted sum of rates, next stage */
    if (status == FB_OK) {
      if (stage == 0 && flies) {
        fbi_flight_begin(work, system);
      }
      fbi_rk4_take(work, system, at, state, dt * weight[stage], stage < 3 ? dt * node[stage] : FB_R(0.0), stage == 3);
    }
  }
  return status == FB_OK ? fbi_system_end(state, work, system, body, end, dt) : status;
}

/* Angular velocity [rad/s], body axes, of a quaternion and its rate: 2 quat^* o rate. */
static void fbi_turn_of_rate(fb_real w[3], const fb_real quat[4], const fb_real rate[4])
{
  const fb_real back[4] = {FB_R(2.0) * quat[0], -FB_R(2.0) * quat[1], -FB_R(2.0) * quat[2], -FB_R(2.0) * quat[3]};
  fb_real turn[4];
  fb_quat_mul(turn, back, rate);
  fbi_vec3_copy(w, turn + 1);
}

/* y -= s K_t x, tangent stiffness of the modes at the present deflection of the link. */
static void fbi_stiffness_sub(fb_real *y, fb_real s, fbi_link_work *L, const fb_body *body, const fb_real *x)
{
  fbi_sparse_eval(y, y, -s, &body->K, x, body->n);
#if FB_WITH_NONLINEAR_STRAIN
  if (fbi_has(body->effects, FB_EFFECT_NONLINEAR_STRAIN)) {
    fbi_strain_tangent_sub(y, s, body, L->k.slope, x);
  }
#endif
  (void)L;
}

/* Right-hand side g r_p - g^2 K r_v of E11.13. */
static void fbi_newton_fill(fb_system_work *w, const fb_system *system, const fb_body *body, const fb_system_state *r,
                            const fb_system_state *at, fb_real g)
{
  fbi_rhs_clear(w, system, body);
  for (int k = 0; k < system->n_body; k++) {
    const fb_joint *joint = fbi_link_joint(system, w, k);
    const fb_body *model = fbi_model(system, body, k);
    const fb_link_state *x = &r->link[k];
    fbi_link_work *L = &w->link[k];

    /* Modes */
    fbi_stiffness_sub(L->pi, g * g, L, model, x->q);
    fbi_row_sub(L->pi, -g, x->pi, model->n);

    /* Momenta of the joint on its free axes */
    fbi_joint_momenta(L->p, L, joint, x);
    for (int i = 0; i < joint->n_axis; i++) {
      L->p[i] = fbi_axis_mode(L, joint, i) == FB_AXIS_FREE ? g * L->p[i] : FB_R(0.0);
    }

    /* Springs of the joint */
    if (joint->kind == FB_JOINT_SPHERICAL) {
      fb_real turn[3];
      fbi_turn_of_rate(turn, at->link[k].quat, x->quat);
      fbi_row_sub(L->p, g * g * joint->stiffness[0], turn, 3);
    }
    for (int i = 0; i < joint->n_axis && joint->kind != FB_JOINT_FREE; i++) {
      const int moves = joint->kind != FB_JOINT_SPHERICAL;
      L->p[i] -= moves ? g * g * joint->stiffness[i] * x->x[i] : FB_R(0.0);
      L->p[i] = L->mode[i] == FB_AXIS_FREE ? L->p[i] : FB_R(0.0);
    }
  }
}

/* r becomes k: k_v = r_v + z, k_p = r_p - g K k_v - C z with the solution z of E11.13. */
static void fbi_newton_take(fb_system_state *r, fb_system_work *w, const fb_system *system, const fb_body *body,
                            const fb_system_state *at, fb_real g)
{
  for (int k = 0; k < system->n_body; k++) {
    const fb_joint *joint = fbi_link_joint(system, w, k);
    const fb_body *model = fbi_model(system, body, k);
    fbi_link_work *L = &w->link[k];
    fb_link_state *x = &r->link[k], move;
    fbi_coordinate_rates(&move, L, joint, &at->link[k]);

    /* Modes */
    fbi_row_sub(x->q, -FB_R(1.0), L->q_dot, model->n);
    fbi_stiffness_sub(x->pi, g, L, model, x->q);
    fbi_damping_add(x->pi, -FB_R(1.0), model, L->q_dot);

    /* Coordinates of the joint, then its momenta by springs and dampers */
    if (fbi_is_ball(joint->kind)) {
      fbi_row_sub(x->quat, -FB_R(1.0), move.quat, 4);
    }
    if (joint->kind == FB_JOINT_FREE) {
      fbi_vec3_add(x->lost_x, FB_R(1.0), move.lost_x);
      fbi_vec3_add_cross(x->p + 3, at->link[k].p, move.lost_x);
    } else if (joint->kind == FB_JOINT_SPHERICAL) {
      fb_real turn[3], torque[3], inertial[3];
      fbi_turn_of_rate(turn, at->link[k].quat, x->quat);
      for (int i = 0; i < 3; i++) {
        turn[i] = -g * joint->stiffness[0] * turn[i] - joint->damping[0] * L->u[i];
      }
      fb_mat33_mul_vec3(torque, joint->child_axes, turn);
      fb_mat33_mul_vec3(inertial, L->k.R, torque);
      fbi_vec3_add(x->p, L->mode[0] == FB_AXIS_FREE ? FB_R(1.0) : FB_R(0.0), inertial);
    } else {
      for (int i = 0; i < joint->n_axis; i++) {
        x->x[i] += move.x[i];
        if (L->mode[i] == FB_AXIS_FREE) {
          x->p[i] -= g * joint->stiffness[i] * x->x[i] + joint->damping[i] * L->u[i];
        }
      }
    }
  }
}

/* [E11.24] Squared size of the increment s k [rad^2]: rotations of joints and attitudes, translations of joints over
   the radius of gyration of their body; deformed: modal displacements over that radius.
   Source: definition.  Cost: 20 flops a body, 2 a mode.  Test: steps_that_have_not_converged_say_so. */
static fb_real fbi_rates_size(fb_real *deformed, const fb_system_state *k, const fb_system *system,
                              const fb_system_work *w, const fb_body *body, fb_real s)
{
  fb_real sum = FB_R(0.0), elastic = FB_R(0.0);
  for (int i = 0; i < system->n_body; i++) {
    const fb_body *model = fbi_model(system, body, i);
    const fb_joint *joint = fbi_link_joint(system, w, i);
    const fb_link_state *x = &k->link[i];
    const fb_real size = model->gyration > FB_R(0.0) ? FB_R(1.0) / model->gyration : FB_R(1.0);
    fb_real bent = FB_R(0.0);

    /* Joint */
    if (fbi_is_ball(joint->kind)) {
      sum += FB_R(4.0) * (x->quat[0] * x->quat[0] + fb_vec3_dot(x->quat + 1, x->quat + 1));
    } else {
      for (int j = 0; j < joint->n_axis; j++) {
        const fb_real move = fbi_axis_slides(joint, j) ? size * x->x[j] : x->x[j];
        sum += move * move;
      }
    }

    /* Modes */
    for (int a = 0; a < model->n; a++) {
      bent += model->reach[a] * FB_FABS(x->q[a]);
    }
    elastic += size * size * bent * bent;
  }
  *deformed = s * s * elastic;
  return s * s * sum;
}

/* [E11.13] Newton iterations for k = f(base + g k): with the residual r = f - k in speeds r_v and momenta r_p,
   (M + g C + g^2 K) z = g r_p - g^2 K r_v,  dk_v = r_v + z,  dk_p = r_p - g K dk_v - C z; under constraints A z = 0.
   K, C: modes, springs and dampers of the tree's joints; M at the present positions.
   Source: block elimination of q' = M^-1 p, p' = -K q - C q'.  Cost: an evaluation and a solution each.
   Fails: as E9.15; FB_ERR_CONVERGENCE (E11.25).
   Test: systems_converge_with_the_order_of_the_integrator, stiff_joints_take_long_steps. */
static fb_status fbi_system_stage(fb_system_work *w, fb_system_state *k, const fb_system *system, const fb_body *body,
                                  const fb_system_state *base, const fb_system_state *modes,
                                  const fb_system_input *input, fb_real g, fb_real dt, int iterations)
{
  fb_status status = FB_OK;
  fb_real first = FB_R(0.0), last = FB_R(0.0), bent = FB_R(0.0), change, bent_change;
  for (int i = 0; i < iterations && status == FB_OK; i++) {
    /* Rates f at base + g k */
    fbi_system_advance(&w->stage, base, g, k, system, w, body);
    fbi_prescribe(&w->stage, system, w, modes, input);
    status = fbi_system_rates(w, system, body, &w->rate, &w->stage, modes, input);
    if (status == FB_OK && i == iterations - 1 && !system->allow_long_step) {
      status = fbi_turns_check(w, system, dt, 0);
    }

    /* Residual f - k and iteration matrix */
    if (status == FB_OK) {
      fbi_system_advance(&w->rate, &w->rate, -FB_R(1.0), k, system, w, body);
      status = fbi_mass_factor(w, system, body, g);
    }

    /* Correction */
    if (status == FB_OK) {
      fbi_newton_fill(w, system, body, &w->rate, &w->stage, g);
      fbi_zero(w->c, w->n_row);
      status = w->n_row > 0 ? fbi_constrained_solve(w, system, body, 0) : fbi_speeds_solve(w, system, body);
    }
    if (status == FB_OK) {
      fbi_newton_take(&w->rate, w, system, body, &w->stage, g);
      fbi_system_advance(k, k, FB_R(1.0), &w->rate, system, w, body);
      last = i == 0 || i == iterations - 1 ? fbi_rates_size(&bent, &w->rate, system, w, body, g) : last;
      first = i == 0 ? last : first;
    }
  }

  /* Convergence (E11.25) */
  if (status == FB_OK && iterations > 1) {
    change = fbi_rates_size(&bent_change, k, system, w, body, g);
    status = fbi_stage_check(first, last, change);
    if (bent > fbi_larger(FB_R(0.01) * bent_change, FB_R(16.0) * FB_EPSILON * FB_EPSILON)) {
      status = FB_ERR_CONVERGENCE; /* separately: small against a free-flying body's motion */
    }
  }
  return status;
}

/* Input interpolated at the fraction s; loads must be at the same nodes in the same axes. */
static fb_status fbi_system_between(fb_system_input *out, const fb_system_input *a, const fb_system_input *b, fb_real s)
{
  *out = *a;
  if (a->n_load != b->n_load || a->rows != b->rows) {
    return FB_ERR_VALUE;
  }

  /* Time and loads */
  out->t += s * (b->t - a->t);
  for (int k = 0; k < a->n_load; k++) {
    const fb_load *x = &a->load[k].load, *y = &b->load[k].load;
    if (a->load[k].body != b->load[k].body || x->node != y->node || x->axes != y->axes) {
      return FB_ERR_VALUE;
    }
    for (int i = 0; i < 3; i++) {
      out->load[k].load.force[i] += s * (y->force[i] - x->force[i]);
      out->load[k].load.torque[i] += s * (y->torque[i] - x->torque[i]);
    }
  }

  /* Drives */
  for (int j = 0; j < FBI_MAX_JOINTS; j++) {
    for (int i = 0; i < 6; i++) {
      out->drive[j].rate[i] += s * (b->drive[j].rate[i] - a->drive[j].rate[i]);
      if (i < 3) {
        out->drive[j].torque[i] += s * (b->drive[j].torque[i] - a->drive[j].torque[i]);
        out->drive[j].value[i] += s * (b->drive[j].value[i] - a->drive[j].value[i]);
      }
    }
  }
  return FB_OK;
}

/* Step limit at the start of E11.14; stores the angular velocities there (E11.26). */
static fb_status fbi_system_sdirk_limited(fb_system_work *w, const fb_system *system, const fb_body *body,
                                          const fb_system_state *state, const fb_system_input *start, fb_real dt)
{
  fb_real spin, stiff, limit;
  fb_status status = fbi_system_rates(w, system, body, &w->first, state, state, start);
  if (status != FB_OK) {
    return status;
  }
  fbi_system_conditions(&spin, &stiff, w, system);
  spin = fbi_larger(FB_R(10.0) * spin, FB_SQRT(stiff + system->limit_kept_elastic));
  limit = fbi_step_limit(FB_R(1.0), fbi_larger(spin, system->limit_kept_damping));
  status = dt <= limit ? FB_OK : FBI_REFUSE_STEP(w, system, 0, dt, limit);
  (void)fbi_turns_check(w, system, dt, 1);
  return status;
}

/* [E11.14] Two-stage SDIRK integrator of order 2 (E11.8) on a system, L-stable: damps stiff joints and modes.
   A free root has its angular momentum in inertial axes only, without E11.27 and E11.28: a thin body that spins about
   its axis converges only with short steps. Measured, a tube of 8.3 kg m^2 across that turns by 0.1 rad/s and about its
   axis by 0.01 rad/s: with 1e-4 of that inertia about the axis the energy is held to 8e-8 in 20000 steps of 0.01 s, the
   spin is off by 4 %; steps of 0.1 s, and with 1e-6 those of 0.01 s, end in FB_ERR_CONVERGENCE, nothing changed. Across
   alone, without that spin, 1e-6 is held to round-off at either step.
   Source: [AL].  Cost: 2 + 2 iterations evaluations, 2 iterations solutions.
   Test: systems_converge_with_the_order_of_the_integrator, stiff_joints_take_long_steps. */
FB_DEF fb_status fb_system_sdirk_step(const fb_system *system, const fb_body *body, fb_system_state *state,
                                      fb_system_work *work, const fb_system_input *start, const fb_system_input *end,
                                      fb_real dt, int iterations)
{
  const fb_real c = FB_R(0.29289321881345248);
  const int count = iterations > 0 ? iterations : 2;
  const fb_system_input *first = start;
  fb_status status;
  int flies;
  FBI_REQUIRE(system && body && state && work, FB_ERR_NULL);
  FBI_REQUIRE((start != NULL) == (end != NULL), FB_ERR_NULL);
  FBI_REQUIRE(iterations >= 0 && iterations <= FBI_MAX_ITERATIONS, FB_ERR_VALUE);
  fbi_system_enter(work, system);
  flies = fbi_flies(system, work);

  /* Inputs, step limit at the start */
  status = fbi_system_step_check(system, body, start, dt);
  status = status == FB_OK ? fbi_system_step_check(system, body, end, dt) : status;
  if (status == FB_OK && start != end) {
    status = fbi_drives_check(work, system, state, start, end);
    status = status ? status : fbi_system_between(&work->between, start, end, c);
    first = &work->between;
  }
  if (status == FB_OK && !system->allow_long_step) {
    status = fbi_system_sdirk_limited(work, system, body, state, start, dt);
  }
  if (status != FB_OK) {
    return status;
  }

  /* First stage */
  if (flies) {
    fbi_links_place(work, system, body, state, state);
    fbi_flight_begin(work, system);
  }
  fbi_system_clear(&work->sum, system, body);
  fbi_links_copy(&work->base, state, system);
  fbi_system_clear(&work->first, system, body);
  work->clock = c * dt;
  status = fbi_system_stage(work, &work->first, system, body, state, state, first, c * dt, dt, count + 1);

  /* Second stage */
  if (status == FB_OK) {
    if (flies) {
      fbi_flight_add(work, system, &work->base, c * dt, &work->first, (FB_R(1.0) - c) * dt);
    }
    work->clock = dt;
    fbi_system_advance(&work->sum, &work->sum, (FB_R(1.0) - c) * dt, &work->first, system, work, body);
    fbi_system_advance(&work->base, state, (FB_R(1.0) - c) * dt, &work->first, system, work, body);
    status = fbi_system_stage(work, &work->first, system, body, &work->base, state, end, c * dt, dt, count);
  }
  if (status != FB_OK) {
    return status;
  }

  /* Increments (1-c) dt k_1 + c dt k_2 */
  if (flies) {
    fbi_flight_add(work, system, &work->base, c * dt, &work->first, c * dt);
  }
  fbi_system_advance(&work->sum, &work->sum, c * dt, &work->first, system, work, body);
  return fbi_system_end(state, work, system, body, end, dt);
}
#endif

#if FB_WITH_EXACT
/* ---- geometrically exact beam */

/* Extrapolation x_(n+1) = 3 x_n - 3 x_(n-1) + x_(n-2), of lower order in the first steps ([L] 3.107, 3.108). */
static void fbi_exact_extrapolate(fb_real *next, const fb_real *a, const fb_real *b, const fb_real *c, int known, int n)
{
  for (int i = 0; i < n; i++) {
    const fb_real line = FB_R(2.0) * a[i] - b[i];
    next[i] = known > 2 ? line + (a[i] - FB_R(2.0) * b[i] + c[i]) : known > 1 ? line : a[i];
  }
}

/* Shifts the history a, b, c and puts x first. */
static void fbi_exact_remember(fb_real *a, fb_real *b, fb_real *c, const fb_real *x, int n)
{
  fbi_copy(c, b, n);
  fbi_copy(b, a, n);
  fbi_copy(a, x, n);
}

/* base = x - beta/2 dt rate_old, dt the shorter of the old step and the new one. With the dissipative rule
   x_alpha = x + dx/2 + beta/2 (dx - dx_old) the rate is 2/((1 + beta) dt) (x_alpha - base). */
static void fbi_exact_rate_base(fb_real *base, const fb_real *x, const fb_real *rate, fb_real beta_dt, int n)
{
  for (int i = 0; i < n; i++) {
    base[i] = x[i] - FB_R(0.5) * beta_dt * rate[i];
  }
}

/* Rate from the value x_alpha at mid-step (middle), and x after the step, small values flushed. */
static void fbi_exact_rate_take(fb_real *x, fb_real *rate, const fb_real *middle, const fb_real *base, fb_real shift,
                                fb_real dt, int n)
{
  for (int i = 0; i < n; i++) {
    rate[i] = shift * (middle[i] - base[i]);
    x[i] += dt * rate[i];
    x[i] = x[i] * x[i] < FB_TINY * FB_TINY ? FB_R(0.0) : x[i];
  }
}

/* [E11.21] Pose increment by Cayley's transform of ad(x), x = (v, w), as the midpoint rule rotates the momenta:
   rotation (1 - w^/2)^-1 (1 + w^/2), translation (v + w/2 x v)/(1 + w.w/4). A free beam then conserves momentum and
   angular momentum in space: all translations, including those along the axis w, are short by the same factor 1 +
   w.w/4, so that the mass center moves along the momentum.
   Source: Cayley's transform of 6x6.  Cost: 60 flops.  Fails: never.
   Test: free_flight_keeps_momentum, rigid_flight_is_straight. */
static void fbi_pose_add_midpoint(fb_real r[3], fb_real quat[4], const fb_real x[6])
{
  const fb_real half[3] = {FB_R(0.5) * x[3], FB_R(0.5) * x[4], FB_R(0.5) * x[5]};
  const fb_real size = FB_R(1.0) + fb_vec3_dot(half, half);
  fb_real turn[4] = {FB_R(1.0), half[0], half[1], half[2]}, step[3];
  fb_vec3_cross(step, half, x);
  for (int i = 0; i < 3; i++) {
    step[i] = (x[i] + step[i]) / size;
  }
  fbi_pose_mul(r, quat, r, quat, step, turn);
}

/* [E11.35] The frame of an unsupported beam falls freely, u_t = g, so that no gravity acts relative to u. Adds the
   displacement of the frame in a step, u dt + g dt^2/2, to y.
   Source: Galilean invariance.  Cost: 20 flops.  Fails: never.  Test: free_fall_is_not_felt. */
static void fbi_exact_fall(fb_real y[3], fb_exact_state *state, const fb_exact *m, fb_real dt)
{
  const fb_real time = dt * m->time, half = FB_R(0.5) * dt * m->length / m->time;
  fbi_vec3_add(state->u, half, m->gravity);
  fbi_vec3_add(y, time, state->u);
  fbi_vec3_add(state->u, half, m->gravity);
}

/* Moves the base (by u and relative to it), the root relative to the base, and all nodes by their strains. The base of
   an unsupported beam moves with its root. */
static void fbi_exact_move(fb_exact_state *state, fb_exact_work *work, const fb_exact *m, fb_real dt)
{
  const fb_real origin[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)}, one[4] = {FB_R(1.0), FB_R(0.0), FB_R(0.0), FB_R(0.0)};
  fb_real x[6], base[6], r[3], quat[4], R[9], y[3], turned[4];

  /* Pose increment r, quat of the base */
  for (int i = 0; i < 6; i++) {
    x[i] = dt * work->V[i];
    base[i] = dt * work->twist[i];
  }
  fbi_copy(r, m->floating ? m->r : origin, 3);
  fbi_copy(quat, m->floating ? m->quat : one, 4);
  if (m->floating) { /* root after the step, then back to the base */
    fb_real back[3], back_quat[4];
    fbi_pose_add_midpoint(r, quat, x);
    fbi_pose_relative(back, back_quat, m->r, m->quat, origin, one);
    fbi_pose_mul(r, quat, r, quat, back, back_quat);
  } else {
    fbi_pose_add(r, quat, base);
  }

  /* Root relative to the new base; constrained coordinates exactly in place */
  if (!m->floating && m->held[0] != FB_END_CLAMPED) {
    fbi_pose_add(state->r, state->quat, x);
    fbi_pose_relative(state->r, state->quat, r, quat, state->r, state->quat);
    for (int i = 0; i < 3; i++) {
      state->r[i] = m->held[0] >> i & 1 ? m->r[i] : state->r[i];
    }
  }

  /* Position of the base, compensated sum */
  if (!m->floating) { /* by its full velocity, independent of u */
    fb_real turn[4];
    fbi_vec3_add(base, dt, work->drift);
    fb_pose_from_twist(r, turn, base);
  }
  fb_quat_to_mat33(R, state->base_quat);
  fb_mat33_mul_vec3(y, R, r);
  for (int i = 0; i < 3; i++) {
    y[i] *= m->length;
  }
  if (m->floating) {
    fbi_exact_fall(y, state, m, dt);
  }
  fbi_sum_kept(y, state->lost, state->base_position, state->lost, 3);
  fbi_copy(state->base_position, y, 3);

  /* Attitude of the base, poses of the nodes */
  fb_quat_mul(turned, state->base_quat, quat);
  (void)fb_quat_normalize(turned);
  fbi_copy(state->base_quat, turned, 4);
  fbi_exact_poses(state->r, state->quat, m, state->strain, state->offset);
}

/* [E11.33] The velocity u of the frame follows the beam. Unsupported beam: u is set to the velocity of the mass center
   after a step in which they differ by more than a thousandth of the beam's length per unit of its time. Supported
   beam: u is set to the velocity of the base if they differ by more than that length per unit of time. Only motion
   relative to u is affected by the factor 1 + w.w/4 of E11.21.
   Source: Galilean invariance.  Cost: 250 flops an element of a free beam, 400 more when it happens.  Fails: never.
   Test: thrust_takes_the_frame_along, flight_at_any_speed_moves_as_rest_does. */
static void fbi_exact_follow(fb_exact_state *state, const fb_exact_work *work, const fb_exact *m, fb_real step)
{
  fb_real du[3], h[3];
  if (m->floating) {
    const fb_real mass = fbi_exact_mass(m);
    fbi_exact_momenta(du, h, m, state, NULL);
    for (int i = 0; i < 3; i++) {
      du[i] = mass > FB_R(0.0) ? du[i] / mass : FB_R(0.0);
    }
  } else {
    fb_mat33_mulT_vec3(du, work->half, work->twist); /* half a step on */
  }
  if (fb_vec3_dot(du, du) > (m->floating ? FB_R(1e-6) : FB_R(1.0))) {
    fbi_exact_reframe(state, m, du, step);
  }
}

#define FBI_EXACT_STEP_TOLERANCE (FB_SINGLE ? FB_R(1e-3) : FB_R(1e-6)) /* of a step's last correction */
/* Strains, momenta, reactions and histories after the step, from the values at mid-step. */
static void fbi_exact_commit(fb_exact_state *next, fb_exact_work *work, const fb_exact *m, fb_real dt)
{
  const fb_real shift = work->motion.shift;
  fb_real strain[6], P[6];

  /* Strains and momenta */
  for (int k = 0; k < m->n; k++) {
    fbi_mat66_mul_vec6(strain, m->C + 36 * k, work->s + 6 * k);
    fbi_exact_rate_take(next->strain + 6 * k, next->strain_rate + 6 * k, strain, work->strain + 6 * k, shift, dt, 6);
    fbi_exact_rate_take(next->momentum + 6 * k, next->momentum_rate + 6 * k, work->P + 6 * k, work->momentum + 6 * k,
                        shift, dt, 6);
  }
  for (int l = 0; l < m->n_lump; l++) {
    fbi_mat66_mul_vec6(P, m->lump + 36 * l, work->V + 6 * m->lump_node[l]);
    fbi_exact_rate_take(next->lump + 6 * l, next->lump_rate + 6 * l, P, work->lump + 6 * l, shift, dt, 6);
  }

  /* Reactions, histories for the extrapolation, internal loads */
  fbi_copy(next->offset, work->offset, 6 * m->n);
  fbi_exact_reactions(next->reaction, work, m);
  fbi_exact_remember(next->V[0], next->V[1], next->V[2], work->V, 6 * (m->n + 1));
  fbi_exact_remember(next->stress[0], next->stress[1], next->stress[2], work->s, 6 * m->n);
  fbi_copy(next->force, work->F, 6 * (m->n + 1));
}

/* Start of a step: loads, base values of the rates, first guess of the mid-step values. */
static void fbi_exact_begin(fb_exact_work *work, const fb_exact *m, const fb_exact_state *state,
                            const fb_exact_input *middle, fb_real step)
{
  const fbi_exact_motion march = {1, 1, 0, 0, FB_R(0.5) * step, FB_R(2.0) / ((FB_R(1.0) + m->beta) * step)};
  const fb_real last = m->beta * (state->step > FB_R(0.0) && state->step < step ? state->step : step);
  fb_real u[3];
  work->motion = march;
  fbi_exact_input_take(work, m, state->base_quat, middle, FB_R(1.0), step);
  fbi_exact_frame(u, m, state);
  fb_mat33_mulT_vec3(work->drift, work->half, u);
  fbi_vec3_add(work->twist, m->floating ? FB_R(0.0) : -FB_R(1.0), work->drift);
  fbi_copy(work->r, state->r, 3 * (m->n + 1));
  fbi_copy(work->quat, state->quat, 4 * (m->n + 1));
  fbi_exact_rate_base(work->strain, state->strain, state->strain_rate, last, 6 * m->n);
  fbi_exact_rate_base(work->momentum, state->momentum, state->momentum_rate, last, 6 * m->n);
  fbi_exact_rate_base(work->lump, state->lump, state->lump_rate, last, 6 * m->n_lump);
  fbi_exact_extrapolate(work->V, state->V[0], state->V[1], state->V[2], state->known, 6 * (m->n + 1));
  fbi_exact_extrapolate(work->s, state->stress[0], state->stress[1], state->stress[2], state->known, 6 * m->n);
}

/* Residuals at the present mid-step values. */
static void fbi_exact_middle(fb_exact_work *work, const fb_exact *m, fb_real step, int aim)
{
  fbi_exact_nodes_eval(work, m);
  fbi_exact_residual(work, m);
  fbi_exact_want(work, m, step, aim);
}

/* Adds the Newton corrections. */
static void fbi_exact_correct(fb_exact_work *work, const fb_exact *m)
{
  for (int i = 0; i < 6 * (m->n + 1); i++) {
    work->V[i] += work->dd[i];
  }
  for (int i = 0; i < 6 * m->n; i++) {
    work->s[i] += work->ds[i];
  }
}

/* Newton iterations with a factorization each; the last factors are kept for the corrections that follow. */
static fb_status fbi_exact_approach(fb_exact_work *work, const fb_exact *m, fb_real step)
{
  fb_status status = fbi_exact_factor(work, m);
  for (int it = 1; it < m->factorizations && status == FB_OK; it++) {
    fbi_exact_solve(work, m);
    fbi_exact_correct(work, m);
    fbi_exact_middle(work, m, step, 1);
    status = fbi_exact_factor(work, m);
  }
  return status;
}

/* Largest residual as a load: compatibility residuals times the stiffness of the element. Constrained nodes are left
   out: their balance gives the reaction, and every correction satisfies their constraints. */
static fb_real fbi_exact_unbalance(const fb_exact_work *work, const fb_exact *m, fb_real step)
{
  fb_real size = FB_R(0.0);
  for (int j = 0; j <= m->n; j++) {
    for (int i = 0; i < 6 && !m->held[j]; i++) {
      size = fbi_larger(size, FB_FABS(work->B[6 * j + i]));
    }
  }
  for (int k = 0; k < m->n; k++) {
    for (int i = 0; i < 6; i++) {
      const fb_real stiffness = step / m->h[k] * m->S[36 * k + 7 * i];
      size = fbi_larger(size, FB_FABS(work->c[6 * k + i]) * fbi_larger(stiffness, step));
    }
  }
  return size;
}

/* State after the step from the mid-step values. */
static void fbi_exact_end(fb_exact_state *state, fb_exact_work *work, const fb_exact *m, fb_real step)
{
  fbi_exact_commit(state, work, m, step);
  fbi_exact_move(state, work, m, step);
  fbi_exact_follow(state, work, m, step);
  state->known = state->known < 3 ? state->known + 1 : 3;
  state->step = step;
}

/* [E11.20] Step of the geometrically exact beam: E10.7 and E10.8 at mid-step, a fixed number of factorizations and of
   Newton corrections. With z of strains and momenta, z_alpha = z + dz/2 + beta/2 (dz - dz_old) in place of the middle:
   the energy with beta/4 dz.dz then falls by beta/4 (dz - dz_old).(dz - dz_old), and what oscillates much faster than
   the step is multiplied by 1 - dissipation in it; beta = rho (1 - rho)/(1 + rho)^2, rho = 1 - dissipation.
   Source: [L] 3.15, 3.107, 3.108; dissipation: own.  Cost: E10.10 and 1.5 kflops an element for each correction.
   Fails: see the header.  Test: energy_is_kept_whatever_the_step, dissipation_takes_energy_in_every_step. */
FB_DEF fb_status fb_exact_step(const fb_exact *m, fb_exact_state *state, fb_exact_work *work,
                               const fb_exact_input *middle, fb_real dt)
{
  fb_real step, change = FB_HUGE, before = FB_HUGE;
  fb_status status;
  FBI_REQUIRE(m && state && work, FB_ERR_NULL);

  /* Checks */
  middle = middle ? middle : fbi_exact_no_input(work);
  status = fb_exact_state_check(m, state);
  status = status ? status : fbi_exact_input_check(m, middle);
  if (status != FB_OK) {
    return status;
  }
  if (!(dt > FB_R(0.0) && dt < FB_HUGE)) {
    return FBI_REFUSE(FB_ERR_VALUE, FBI_WORD_DT, -1, dt, FB_R(0.0));
  }

  /* Residual and factors at mid-step */
  step = dt / m->time;
  fbi_exact_begin(work, m, state, middle, step);
  fbi_exact_middle(work, m, step, 1);
  status = fbi_exact_approach(work, m, step);

  /* Corrections with these factors */
  for (int it = 0; it < m->iterations && status == FB_OK; it++) {
    before = it + 1 == m->iterations ? fbi_exact_unbalance(work, m, step) : before;
    fbi_exact_solve(work, m);
    fbi_exact_correct(work, m);
    change = fbi_exact_change(work, m, step, FB_R(0.0));
    fbi_exact_middle(work, m, step, it + 3 < m->iterations);
  }

  /* Convergence: last correction and the expected next one */
  if (status == FB_OK) {
    const fb_real after = fbi_exact_unbalance(work, m, step);
    const fb_real next = change * (after / (fbi_larger(before, after) + FB_TINY)); /* expected next correction */
    status = fbi_larger(change, FB_R(10.0) * next) < FBI_EXACT_STEP_TOLERANCE ? FB_OK : FB_ERR_CONVERGENCE;
  }
  if (status == FB_OK) {
    fbi_exact_end(state, work, m, step);
  }
  return status;
}
#endif

/* ---- any of them */

/* Is only one of body, system and exact beam described, with nothing of the others? */
static int fbi_stepper_is_one(const fb_stepper_desc *d)
{
  int exact = 0, system = 0;
  const int body = d->state || d->input || d->exponential;
#if FB_WITH_SYSTEM
  system = d->system || d->system_state || d->system_work || d->system_input;
#endif
#if FB_WITH_EXACT
  exact = d->exact || d->exact_state || d->exact_work || d->exact_input;
#endif
  return body + system + exact <= 1 && !(exact && d->body);
}

/* What each of the three must have: FB_ERR_NULL, FB_ERR_UNSUPPORTED, what the check of its state returns. */
static fb_status fbi_stepper_kind(const fb_stepper_desc *d)
{
#if FB_WITH_EXACT
  if (d->exact) {
    FBI_REQUIRE(d->exact_state && d->exact_work, FB_ERR_NULL);
    return d->integrator <= FB_INTEGRATOR_MIDPOINT
               ? fb_exact_state_check(d->exact, d->exact_state)
               : FBI_REFUSE(FB_ERR_UNSUPPORTED, "integrator of an exact beam, its own: FB_INTEGRATOR_RK4 or _MIDPOINT",
                            -1, FB_R(0.0), FB_R(0.0));
  }
#endif
#if FB_WITH_SYSTEM
  if (d->system) {
    FBI_REQUIRE(d->body && d->system_state && d->system_work, FB_ERR_NULL);
    return d->integrator == FB_INTEGRATOR_RK4 || d->integrator == FB_INTEGRATOR_SDIRK
               ? fb_system_state_check(d->system, d->body, d->system_state)
               : FBI_REFUSE(FB_ERR_UNSUPPORTED, "integrator of a system, FB_INTEGRATOR_RK4 or _SDIRK", -1, FB_R(0.0),
                            FB_R(0.0));
  }
#endif
  FBI_REQUIRE(d->body && d->state && (d->integrator != FB_INTEGRATOR_EXPONENTIAL || d->exponential), FB_ERR_NULL);
  return fb_state_check(d->body, d->state);
}

FB_DEF fb_status fb_stepper_init(fb_stepper *stepper, const fb_stepper_desc *desc)
{
  fb_status status;
  FBI_REQUIRE(stepper && desc, FB_ERR_NULL);

  /* What is stepped, and by what */
  if (!fbi_is_choice((int)desc->integrator, (int)FB_INTEGRATOR_COUNT - 1)) {
    return FBI_REFUSE(FB_ERR_VALUE, "integrator, an fb_integrator, beyond", -1, (fb_real)(int)desc->integrator,
                      (int)desc->integrator < 0 ? FB_R(0.0) : (fb_real)(int)FB_INTEGRATOR_COUNT - FB_R(1.0));
  }
  if (!fbi_stepper_is_one(desc)) {
    return FBI_REFUSE(FB_ERR_VALUE, "body, system or exact beam: one of them, nothing of the others", -1, FB_R(0.0),
                      FB_R(0.0));
  }
  status = fbi_stepper_kind(desc);
  if (status != FB_OK) {
    return status;
  }

  /* Numbers */
  if (!(desc->dt > FB_R(0.0) && desc->dt < FB_HUGE)) {
    return FBI_REFUSE(FB_ERR_VALUE, FBI_WORD_DT, -1, desc->dt, FB_R(0.0));
  }
  if (!fbi_is_choice(desc->iterations, FBI_MAX_ITERATIONS)) {
    return FBI_REFUSE(FB_ERR_VALUE, "iterations, 0 to 50, beyond", -1, (fb_real)desc->iterations,
                      desc->iterations < 0 ? FB_R(0.0) : FB_R(1.0) * FBI_MAX_ITERATIONS);
  }
  if (desc->n_input != 0 && desc->n_input != 1 && desc->n_input != 3) {
    return FBI_REFUSE(FB_ERR_VALUE, "n_input, 0, 1 or 3", -1, FB_R(0.0), FB_R(0.0));
  }
  if (desc->integrator == FB_INTEGRATOR_EXPONENTIAL && !(desc->exponential->dt == desc->dt)) {
    return FBI_REFUSE(FB_ERR_VALUE, "dt [s], that of the exponential, equal to", -1, desc->dt, desc->exponential->dt);
  }
  memset(stepper, 0, sizeof *stepper);
  stepper->desc = *desc;
  return FB_OK;
}

static fb_status fbi_stepper_body(fb_stepper *stepper)
{
  const fb_stepper_desc *const d = &stepper->desc;
  const int apart = d->n_input == 3 && d->input;
  const fb_input *const start = d->input, *const middle = apart ? start + 1 : start,
                        *const end = apart ? start + 2 : start;
  switch (d->integrator) {
  case FB_INTEGRATOR_MIDPOINT:
    return fb_midpoint_step(d->body, d->state, &stepper->work.implicit, middle, d->dt, d->iterations);
  case FB_INTEGRATOR_SDIRK:
    return fb_sdirk_step(d->body, d->state, &stepper->work.implicit, start, end, d->dt, d->iterations);
  case FB_INTEGRATOR_EXPONENTIAL:
    return fb_exponential_step(d->body, d->exponential, d->state, &stepper->work.exponential, start, middle, end);
  case FB_INTEGRATOR_RK4:
    return fb_rk4_step(d->body, d->state, &stepper->work.rk4, start, middle, end, d->dt);
  case FB_INTEGRATOR_COUNT:
    break;
  }
  return FB_ERR_VALUE;
}

#if FB_WITH_SYSTEM
static fb_status fbi_stepper_system(const fb_stepper_desc *d)
{
  const int apart = d->n_input == 3 && d->system_input;
  const fb_system_input *const start = d->system_input, *const middle = apart ? start + 1 : start;
  const fb_system_input *const end = apart ? start + 2 : start;
  if (d->integrator == FB_INTEGRATOR_SDIRK) {
    return fb_system_sdirk_step(d->system, d->body, d->system_state, d->system_work, start, end, d->dt, d->iterations);
  }
  return fb_system_rk4_step(d->system, d->body, d->system_state, d->system_work, start, middle, end, d->dt);
}
#endif

static fb_status fbi_stepper_advance(fb_stepper *stepper)
{
  const fb_stepper_desc *const d = &stepper->desc;
#if FB_WITH_EXACT
  if (d->exact) {
    const fb_exact_input *const middle = d->exact_input && d->n_input == 3 ? d->exact_input + 1 : d->exact_input;
    return fb_exact_step(d->exact, d->exact_state, d->exact_work, middle, d->dt);
  }
#endif
#if FB_WITH_SYSTEM
  if (d->system) {
    return fbi_stepper_system(d);
  }
#endif
  (void)d;
  return fbi_stepper_body(stepper);
}

FB_DEF fb_status fb_stepper_step(fb_stepper *stepper)
{
  fb_status status;
  FBI_REQUIRE(stepper, FB_ERR_NULL);
  status = fbi_stepper_advance(stepper);
  if (status == FB_OK) {
    fb_real t = stepper->desc.dt;
    fbi_sum_kept(&t, &stepper->lost_t, &stepper->t, &stepper->lost_t, 1);
    stepper->t = t;
  }
  return status;
}

/* ---------------------------------------------------------------------------------------------------------------
   RUN >>version: version, configuration, build check (uses config, status) */

FB_DEF const char *fb_version_string(void)
{
  return FB_VERSION;
}

FB_DEF const char *fb_config_string(void)
{
  return FB_CONFIG;
}

FB_DEF fb_status fb_config_check(const char *config)
{
  FBI_REQUIRE(config, FB_ERR_NULL);
  return strcmp(config, FB_CONFIG) == 0 ? FB_OK : FB_ERR_VALUE;
}

FB_DEF fb_status fb_build_check(void)
{
  return fbi_is_exact() ? FB_OK : FB_ERR_BUILD;
}

#if FB_WITH_BUILD
/* ---------------------------------------------------------------------------------------------------------------
   BUILD >>eigen: symmetric, generalized and general eigenproblems (uses config, status, solve) */

/* Plane rotation of n pairs: (x, y) becomes (c x - s y, s x + c y); x and y have strides. */
static void fbi_pairs_rotate(fb_real *x, int x_stride, fb_real *y, int y_stride, fb_real c, fb_real s, int n)
{
  for (int i = 0; i < n; i++) {
    const fb_real a = x[i * x_stride], b = y[i * y_stride];
    x[i * x_stride] = c * a - s * b;
    y[i * y_stride] = s * a + c * b;
  }
}

/* Jacobi rotation of rows and columns p < q of a symmetric matrix that makes A_pq zero; rows p, q of V rotate along.
   d is the diagonal, A holds the elements above it. */
static void fbi_jacobi_rotate(fb_real *d, fb_real *V, fb_real *A, int n, int p, int q)
{
  fb_real *const row_p = A + p * n, *const row_q = A + q * n;
  const fb_real apq = row_p[q];

  /* t, c, s: tangent, cosine, sine of the angle; t is the smaller root of t^2 + 2 theta t - 1 = 0 */
  const fb_real theta = (d[q] - d[p]) / (FB_R(2.0) * apq);
  const fb_real root = FB_FABS(theta) < FB_HUGE ? FB_SQRT(theta * theta + FB_R(1.0)) : FB_FABS(theta);
  const fb_real t = (theta < FB_R(0.0) ? -FB_R(1.0) : FB_R(1.0)) / (FB_FABS(theta) + root);
  const fb_real c = FB_R(1.0) / FB_SQRT(t * t + FB_R(1.0));
  const fb_real s = t * c;

  /* The 2x2 block of p and q becomes diagonal */
  d[p] -= t * apq;
  d[q] += t * apq;
  row_p[q] = FB_R(0.0);

  /* The other elements of the two rows and columns: above p, between p and q, beyond q; and V */
  fbi_pairs_rotate(A + p, n, A + q, n, c, s, p);
  fbi_pairs_rotate(row_p + p + 1, 1, row_p + n + q, n, c, s, q - p - 1);
  fbi_pairs_rotate(row_p + q + 1, 1, row_q + q + 1, 1, c, s, n - q - 1);
  fbi_pairs_rotate(V + p * n, 1, V + q * n, 1, c, s, n);
}

/* Sorts d and the rows of V ascending (selection: n exchanges at most). */
static void fbi_eig_sort(fb_real *d, fb_real *V, int n)
{
  for (int i = 0; i < n; i++) {
    int least = i;
    for (int j = i + 1; j < n; j++) {
      least = d[j] < d[least] ? j : least;
    }
    if (least != i) {
      fbi_swap(d + i, d + least, 1);
      fbi_swap(V + i * n, V + least * n, n);
    }
  }
}

/* [E5.3] Symmetric eigenvalues by cyclic Jacobi rotations until every off-diagonal element is round-off of its two
   diagonal ones (or of 1e-9 of the norm, where those vanish): small eigenvalues of graded matrices keep their digits.
   Source: [GV] 8.5.  Shapes: d n, the diagonal before and the eigenvalues after; V rows; A n x n, the elements above
   the diagonal, the others are neither read nor written.  Cost: about 6 n^3 flops a sweep, 5 to 10 sweeps.
   Fails: more than 60 sweeps.  Test: jacobi_diagonalizes_random_graded_and_degenerate_matrices. */
static fb_status fbi_jacobi_solve(fb_real *d, fb_real *V, fb_real *A, int n)
{
  fb_real norm = FB_R(0.0);
  int rotated = 1;

  /* V = 1; norm is the largest element of A */
  for (int i = 0; i < n; i++) {
    fbi_zero(V + i * n, n);
    V[i * n + i] = FB_R(1.0);
    norm = fbi_larger(norm, FB_FABS(d[i]));
    for (int j = i + 1; j < n; j++) {
      norm = fbi_larger(norm, FB_FABS(A[i * n + j]));
    }
  }

  /* Sweeps until no element needs a rotation */
  for (int sweep = 0; sweep < 60 && rotated; sweep++) {
    rotated = 0;
    for (int p = 0; p < n - 1; p++) {
      for (int q = p + 1; q < n; q++) {
        const fb_real own = FB_SQRT(FB_FABS(d[p])) * FB_SQRT(FB_FABS(d[q]));
        if (FB_FABS(A[p * n + q]) > FB_EPSILON * fbi_larger(own, FB_R(1e-9) * norm)) {
          fbi_jacobi_rotate(d, V, A, n, p, q);
          rotated = 1;
        }
      }
    }
  }
  if (rotated) {
    return FB_ERR_CONVERGENCE;
  }
  fbi_eig_sort(d, V, n);
  return FB_OK;
}

FB_DEF fb_status fb_eig_sym_solve(fb_real *d, fb_real *V, fb_real *A, int n)
{
  FBI_REQUIRE_INNER(d && V && A, FB_ERR_NULL);
  FBI_REQUIRE_INNER(n >= 0, FB_ERR_VALUE);
  for (int i = 0; i < n; i++) {
    if (!fbi_is_finite(A + i * n, n)) {
      return FB_ERR_NOT_FINITE;
    }
  }
  for (int i = 0; i < n; i++) {
    d[i] = A[i * n + i];
  }
  return fbi_jacobi_solve(d, V, A, n);
}

/* [E5.4] K x = d M x through M = L L^T, (L^-1 K L^-T) y = d y, x = L^-T y.
   Source: [GV] 8.7.  Shapes: X n x n, K before and the eigenvectors in rows after; A n x n, M in the lower triangle,
   where L overwrites it, and scratch above.  Cost: E5.3 and 2 n^3 flops.  Fails: M not positive definite.
   Test: generalized_eigenvectors_diagonalize_both_matrices. */
static fb_status fbi_eig_gen_solve(fb_real *d, fb_real *X, fb_real *A, int n)
{
  /* M = L L^T */
  fb_status status = fb_chol_factor(A, n);
  if (status != FB_OK) {
    return status;
  }

  /* K becomes L^-1 K L^-T: solve with the rows, transpose, solve again */
  for (int pass = 0; pass < 2; pass++) {
    for (int i = 0; i < n; i++) {
      fbi_chol_forward(X + i * n, A, X + i * n, n);
    }
    for (int i = 0; i < n && pass == 0; i++) {
      for (int j = 0; j < i; j++) {
        fbi_swap(X + i * n + j, X + j * n + i, 1);
      }
    }
  }

  /* Its symmetric part, above the diagonal of A and in d */
  for (int i = 0; i < n; i++) {
    if (!fbi_is_finite(X + i * n, n)) {
      return FB_ERR_NOT_FINITE;
    }
    d[i] = X[i * n + i];
    for (int j = i + 1; j < n; j++) {
      A[i * n + j] = FB_R(0.5) * (X[j * n + i] + X[i * n + j]);
    }
  }

  /* Eigenvectors y of that, and x = L^-T y */
  status = fbi_jacobi_solve(d, X, A, n);
  for (int k = 0; k < n && status == FB_OK; k++) {
    fbi_chol_back(X + k * n, A, X + k * n, n);
  }
  return status;
}

FB_DEF fb_status fb_eig_gen_solve(fb_real *d, fb_real *X, const fb_real *K, fb_real *M, int n)
{
  FBI_REQUIRE_INNER(d && X && K && M, FB_ERR_NULL);
  FBI_REQUIRE_INNER(n >= 0, FB_ERR_VALUE);
  fbi_copy(X, K, n * n);
  return fbi_eig_gen_solve(d, X, M, n);
}

/* Complex numbers of the general eigenproblem. */
typedef struct fbi_complex {
  fb_real re, im;
} fbi_complex;

static fbi_complex fbi_complex_mul(fbi_complex a, fbi_complex b)
{
  const fbi_complex c = {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
  return c;
}

static fb_real fbi_complex_abs(fbi_complex a)
{
  const fb_real x = FB_FABS(a.re), y = FB_FABS(a.im), large = fbi_larger(x, y);
  const fb_real ratio = large > FB_R(0.0) ? (x + y - large) / large : FB_R(0.0);
  return large * FB_SQRT(FB_R(1.0) + ratio * ratio);
}

/* a / b by Smith's method, which avoids overflow */
static fbi_complex fbi_complex_div(fbi_complex a, fbi_complex b)
{
  fbi_complex c;
  if (FB_FABS(b.re) >= FB_FABS(b.im)) {
    const fb_real r = b.im / b.re, d = b.re + r * b.im;
    c.re = (a.re + r * a.im) / d;
    c.im = (a.im - r * a.re) / d;
  } else {
    const fb_real r = b.re / b.im, d = b.im + r * b.re;
    c.re = (r * a.re + a.im) / d;
    c.im = (r * a.im - a.re) / d;
  }
  return c;
}

/* Principal square root */
static fbi_complex fbi_complex_sqrt(fbi_complex a)
{
  const fb_real size = fbi_complex_abs(a);
  fbi_complex c = {FB_SQRT(FB_R(0.5) * (size + FB_FABS(a.re))), FB_R(0.0)};
  c.im = c.re > FB_R(0.0) ? FB_R(0.5) * FB_FABS(a.im) / c.re : FB_R(0.0);
  if (a.re < FB_R(0.0)) {
    const fb_real t = c.re;
    c.re = c.im;
    c.im = t;
  }
  c.im = a.im < FB_R(0.0) ? -c.im : c.im;
  return c;
}

/* Balancing: A becomes D^-1 A D, D diagonal with powers of two, so that row i and column i have like norms. A state
   matrix mixes units. */
static void fbi_balance(fb_real *A, fb_real *D, int n)
{
  int changed = 1;
  for (int i = 0; i < n; i++) {
    D[i] = FB_R(1.0);
  }
  for (int sweep = 0; sweep < 100 && changed; sweep++) {
    changed = 0;
    for (int i = 0; i < n; i++) {
      /* Norms of row and column i without the diagonal */
      fb_real row = FB_R(0.0), column = FB_R(0.0), f = FB_R(1.0), s;
      for (int j = 0; j < n; j++) {
        row += j != i ? FB_FABS(A[i * n + j]) : FB_R(0.0);
        column += j != i ? FB_FABS(A[j * n + i]) : FB_R(0.0);
      }
      if (!(row > FB_R(0.0) && column > FB_R(0.0))) {
        continue;
      }

      /* Power of two f that brings column f and row / f together */
      s = row + column;
      for (int k = 0; k < 200 && column * f < FB_R(0.5) * row / f; k++) {
        f *= FB_R(2.0);
      }
      for (int k = 0; k < 200 && column * f > FB_R(2.0) * row / f; k++) {
        f *= FB_R(0.5);
      }

      /* Scaled only where that lowers the sum by 5 % or more */
      if (column * f + row / f < FB_R(0.95) * s) {
        changed = 1;
        D[i] *= f;
        for (int j = 0; j < n; j++) {
          A[i * n + j] /= f;
        }
        for (int j = 0; j < n; j++) {
          A[j * n + i] *= f;
        }
      }
    }
  }
}

/* Hessenberg form A = Q H Q^T (H zero below the first subdiagonal) by Householder reflections; H overwrites A. */
static void fbi_hessenberg(fb_real *A, fb_real *Q, int n)
{
  /* Q = 1 */
  for (int i = 0; i < n * n; i++) {
    Q[i] = i / n == i % n ? FB_R(1.0) : FB_R(0.0);
  }
  for (int k = 0; k + 2 < n; k++) {
    /* Householder vector v of column k, scaled and stored in that column */
    fb_real scale = FB_R(0.0), norm2 = FB_R(0.0), alpha;
    for (int i = k + 1; i < n; i++) {
      scale = fbi_larger(scale, FB_FABS(A[i * n + k]));
    }
    if (!(scale > FB_R(0.0))) {
      continue;
    }
    for (int i = k + 1; i < n; i++) {
      A[i * n + k] /= scale;
      norm2 += A[i * n + k] * A[i * n + k];
    }
    alpha = FB_SQRT(norm2) * (A[(k + 1) * n + k] > FB_R(0.0) ? -FB_R(1.0) : FB_R(1.0));
    norm2 -= alpha * A[(k + 1) * n + k]; /* v^T v / 2 */
    A[(k + 1) * n + k] -= alpha;

    /* A from the left: A -= v (v^T A) / norm2 */
    for (int j = k + 1; j < n; j++) {
      fb_real sum = FB_R(0.0);
      for (int i = k + 1; i < n; i++) {
        sum += A[i * n + k] * A[i * n + j];
      }
      for (int i = k + 1; i < n; i++) {
        A[i * n + j] -= sum / norm2 * A[i * n + k];
      }
    }

    /* A and Q from the right */
    for (int i = 0; i < 2 * n; i++) {
      fb_real *row = i < n ? A + i * n : Q + (i - n) * n, sum = FB_R(0.0);
      for (int j = k + 1; j < n; j++) {
        sum += A[j * n + k] * row[j];
      }
      for (int j = k + 1; j < n; j++) {
        row[j] -= sum / norm2 * A[j * n + k];
      }
    }

    /* Column k of H */
    A[(k + 1) * n + k] = alpha * scale;
    for (int i = k + 2; i < n; i++) {
      A[i * n + k] = FB_R(0.0);
    }
  }
}

/* Givens rotation: (x, y) becomes (c x + s y, c y - s* x); for two rows with s, for two columns with s*. */
static void fbi_complex_turn(fbi_complex *x, fbi_complex *y, fb_real c, fbi_complex s)
{
  const fbi_complex conjugate = {s.re, -s.im};
  const fbi_complex sy = fbi_complex_mul(s, *y), sx = fbi_complex_mul(conjugate, *x);
  x->re = c * x->re + sy.re;
  x->im = c * x->im + sy.im;
  y->re = c * y->re - sx.re;
  y->im = c * y->im - sx.im;
}

/* One QR step with a shift on rows and columns low..high of H by Givens rotations (bulge chasing); Q accumulates
   them. */
static void fbi_qr_step(fbi_complex *H, fbi_complex *Q, int low, int high, fbi_complex shift, int n)
{
  fbi_complex x = H[low * n + low], y = H[(low + 1) * n + low];
  x.re -= shift.re;
  x.im -= shift.im;
  for (int k = low; k < high; k++) {
    /* Rotation (c, s) that takes (x, y) to (r, 0) */
    const fb_real ax = fbi_complex_abs(x), ay = fbi_complex_abs(y);
    const fb_real norm = FB_SQRT(ax * ax + ay * ay), c = norm > FB_R(0.0) ? ax / norm : FB_R(1.0);
    fbi_complex s = {y.re, -y.im}, conjugate;
    if (ax > FB_R(0.0)) {
      const fbi_complex phase = {x.re / ax, x.im / ax};
      s = fbi_complex_mul(phase, s);
    }
    s.re = norm > FB_R(0.0) ? s.re / norm : FB_R(0.0);
    s.im = norm > FB_R(0.0) ? s.im / norm : FB_R(0.0);
    conjugate.re = s.re;
    conjugate.im = -s.im;

    /* H = G H G^H, Q = Q G^H */
    for (int j = k > low ? k - 1 : low; j < n; j++) {
      fbi_complex_turn(&H[k * n + j], &H[(k + 1) * n + j], c, s);
    }
    for (int i = 0; i <= (k + 2 < high ? k + 2 : high); i++) {
      fbi_complex_turn(&H[i * n + k], &H[i * n + k + 1], c, conjugate);
    }
    for (int i = 0; i < n; i++) {
      fbi_complex_turn(&Q[i * n + k], &Q[i * n + k + 1], c, conjugate);
    }

    /* The next pair: subdiagonal element and the bulge below it */
    if (k + 1 < high) {
      x = H[(k + 1) * n + k];
      y = H[(k + 2) * n + k];
    }
  }
}

/* Wilkinson's shift: the eigenvalue of the last 2x2 block that is nearer to its last element. */
static fbi_complex fbi_qr_shift(const fbi_complex *H, int high, int n)
{
  const fbi_complex a = H[(high - 1) * n + high - 1], d = H[high * n + high];
  const fbi_complex bc = fbi_complex_mul(H[(high - 1) * n + high], H[high * n + high - 1]);
  fbi_complex t = {FB_R(0.5) * (a.re - d.re), FB_R(0.5) * (a.im - d.im)}, root, shift = d;
  root = fbi_complex_mul(t, t);
  root.re += bc.re;
  root.im += bc.im;
  root = fbi_complex_sqrt(root);
  if (t.re * root.re + t.im * root.im < FB_R(0.0)) {
    root.re = -root.re;
    root.im = -root.im;
  }
  t.re += root.re;
  t.im += root.im;
  if (fbi_complex_abs(t) > FB_R(0.0)) {
    root = fbi_complex_div(bc, t);
    shift.re -= root.re;
    shift.im -= root.im;
  }
  return shift;
}

/* Triangularizes the complex Hessenberg matrix H by QR steps with deflation; returns 0 if it does not converge. */
static int fbi_qr_iterate(fbi_complex *H, fbi_complex *Q, int n)
{
  int high = n - 1, since = 0;
  for (int step = 0; step < 60 * n && high > 0; step++) {
    /* Active block low..high; a negligible subdiagonal element is set to zero */
    int low = high;
    for (; low > 0; low--) {
      const fb_real near = fbi_complex_abs(H[low * n + low]) + fbi_complex_abs(H[(low - 1) * n + low - 1]);
      if (fbi_complex_abs(H[low * n + low - 1]) <= FB_EPSILON * near) {
        H[low * n + low - 1].re = H[low * n + low - 1].im = FB_R(0.0);
        break;
      }
    }

    /* A block of one row has converged (deflation), another one gets a QR step */
    if (low == high) {
      high--;
      since = 0;
    } else {
      fbi_complex shift = fbi_qr_shift(H, high, n);
      if (++since % 12 == 0) { /* exceptional shift, breaks cycles */
        shift.re += fbi_complex_abs(H[high * n + high - 1]);
      }
      fbi_qr_step(H, Q, low, high, shift, n);
    }
  }
  return high == 0 || n == 0;
}

/* Eigenvector k of the upper triangular H by back-substitution: elements 0..k of x. */
static void fbi_triangular_vector(fbi_complex *x, const fbi_complex *H, fb_real norm, int k, int n)
{
  const fbi_complex lambda = H[k * n + k];
  x[k].re = FB_R(1.0);
  x[k].im = FB_R(0.0);
  for (int j = k - 1; j >= 0; j--) {
    fbi_complex sum = {FB_R(0.0), FB_R(0.0)}, d = {lambda.re - H[j * n + j].re, lambda.im - H[j * n + j].im};
    fb_real size;
    for (int i = j + 1; i <= k; i++) {
      const fbi_complex p = fbi_complex_mul(H[j * n + i], x[i]);
      sum.re += p.re;
      sum.im += p.im;
    }
    if (!(fbi_complex_abs(d) > FB_EPSILON * norm)) { /* multiple eigenvalue: perturbed by round-off */
      d.re = FB_EPSILON * norm;
      d.im = FB_R(0.0);
    }
    x[j] = fbi_complex_div(sum, d);

    /* Scaled down against overflow */
    size = fbi_complex_abs(x[j]);
    for (int i = j; i <= k && size > FB_R(1e6); i++) {
      x[i].re /= size;
      x[i].im /= size;
    }
  }
}

/* [E5.6] Eigenvalues and vectors of a general real matrix: balanced, Hessenberg form, shifted QR iteration in complex
   numbers, back substitution.
   Source: [GV] 7.4-7.6.  Shapes: see the header.  Cost: about 25 n^3 complex multiplications.
   least: round-off of the eigenvalues; imaginary parts below it are set to zero.
   Fails: not finite; 60 n steps.  Test: general_eigenvectors_satisfy_their_equation. */
static fb_status fbi_eig_general(fb_real *re, fb_real *im, fb_real *X, fb_real *least, fb_real *A, fb_real *work, int n)
{
  fb_real norm = FB_R(0.0);
  *least = FB_R(0.0);
  {
    fbi_complex *const H = (fbi_complex *)(void *)work, *const Q = H + n * n, *const x = (fbi_complex *)(void *)A;
    for (int i = 0; i < n; i++) {
      if (!fbi_is_finite(A + i * n, n)) {
        return FB_ERR_NOT_FINITE;
      }
    }
    if (n == 1) {
      re[0] = A[0];
      im[0] = X[1] = FB_R(0.0);
      X[0] = FB_R(1.0);
      return FB_OK;
    }

    /* A = D Q H Q^T D^-1: re holds D, the complex Q starts as D Q */
    fbi_balance(A, re, n);
    fbi_hessenberg(A, X, n);
    for (int i = 0; i < n * n; i++) {
      H[i].re = A[i];
      H[i].im = Q[i].im = FB_R(0.0);
      Q[i].re = re[i / n] * X[i];
      norm = fbi_larger(norm, FB_FABS(A[i]));
    }

    /* Triangular form */
    if (!fbi_qr_iterate(H, Q, n)) {
      return FB_ERR_CONVERGENCE;
    }
    *least = (fb_real)n * FB_EPSILON * norm;

    /* Eigenvectors (D Q) x of unit length; eigenvalues from the diagonal */
    for (int k = 0; k < n; k++) {
      fb_real *row = X + 2 * n * k, length = FB_R(0.0);
      fbi_triangular_vector(x, H, norm > FB_R(0.0) ? norm : FB_R(1.0), k, n);
      for (int i = 0; i < n; i++) {
        fbi_complex sum = {FB_R(0.0), FB_R(0.0)};
        for (int j = 0; j <= k; j++) {
          const fbi_complex p = fbi_complex_mul(Q[i * n + j], x[j]);
          sum.re += p.re;
          sum.im += p.im;
        }
        row[i] = sum.re;
        row[n + i] = sum.im;
        length += sum.re * sum.re + sum.im * sum.im;
      }
      length = FB_SQRT(length);
      for (int i = 0; i < 2 * n; i++) {
        row[i] /= length;
      }
      re[k] = H[k * n + k].re;
      im[k] = FB_FABS(H[k * n + k].im) > *least ? H[k * n + k].im : FB_R(0.0);
    }
  }
  return FB_OK;
}

FB_DEF fb_status fb_eig_general_solve(fb_real *re, fb_real *im, fb_real *X, fb_real *A, fb_real *work, int n)
{
  fb_real least;
  FBI_REQUIRE_INNER(re && im && X && A && work, FB_ERR_NULL);
  FBI_REQUIRE_INNER(n >= 0, FB_ERR_VALUE);
  return fbi_eig_general(re, im, X, &least, A, work, n);
}

/* ---------------------------------------------------------------------------------------------------------------
   BUILD >>beam: sections, stations, lumped bodies, element matrices (uses config, status, vec3, rotation, solve) */

/* Names: station, a place with given section properties, linear in between; lump, a rigid (lumped) body fixed to a
   node; cell, an integration interval; chain, a beam along a polygon of points. */

#define FBI_WORD_ATTITUDE "attitude, a quaternion whose length can be brought to 1, or all zero"

/* Unit quaternion of a desc's attitude; all zeros mean identity. */
static fb_status fbi_quat_from_attitude(fb_real q[4], const fb_real attitude[4])
{
  for (int i = 0; i < 4; i++) {
    q[i] = attitude[i];
  }
  q[0] = fbi_is_zero(attitude, 4) ? FB_R(1.0) : q[0];
  return fb_quat_normalize(q) == FB_OK ? FB_OK : FBI_REFUSE(FB_ERR_VALUE, FBI_WORD_ATTITUDE, -1, FB_R(0.0), FB_R(0.0));
}

/* Nine Gauss quadrature points on 0..1: integrals exact to degree 17, partial ones (fbi_partial_weights) to 8. */
#define FBI_GAUSS 9
static const fb_real fbi_gauss_x[FBI_GAUSS] = {FB_R(0.01591988024618695),
                                               FB_R(0.08198444633668210),
                                               FB_R(0.19331428364970480),
                                               FB_R(0.33787328829809555),
                                               FB_R(0.5),
                                               FB_R(0.66212671170190445),
                                               FB_R(0.80668571635029520),
                                               FB_R(0.91801555366331790),
                                               FB_R(0.98408011975381305)};

static const fb_real fbi_gauss_w[FBI_GAUSS] = {
    FB_R(0.04063719418078720), FB_R(0.09032408034742870), FB_R(0.13030534820146770),
    FB_R(0.15617353852000145), FB_R(0.16511967750062990), FB_R(0.15617353852000145),
    FB_R(0.13030534820146770), FB_R(0.09032408034742870), FB_R(0.04063719418078720)};

#if FB_WITH_NONLINEAR_STRAIN
/* [E6.8] Gauss-Legendre points and weights on 0..1, n <= FBI_RULE: Newton's iteration on P_n from its asymptotic zeros.
   Source: Abramowitz and Stegun 25.4.29.  Cost: 10 n^2 flops x 6.  Fails: never.
   Test: gauss_rules_integrate_polynomials. */
#define FBI_RULE 15
static void fbi_gauss_rule(fb_real *x, fb_real *w, int n)
{
  for (int i = 0; i < n; i++) {
    /* r: zero i of P_n on -1..1, started at its asymptotic value */
    fb_real r = -FB_COS(FB_R(3.14159265358979324) * ((fb_real)i + FB_R(0.75)) / ((fb_real)n + FB_R(0.5)));
    fb_real slope = FB_R(1.0);
    for (int newton = 0; newton < 6; newton++) {
      /* P_n by the three-term recurrence, then one Newton step */
      fb_real P = FB_R(1.0), Q = FB_R(0.0); /* P_j, P_(j-1) */
      for (int j = 0; j < n; j++) {
        const fb_real N = ((fb_real)(2 * j + 1) * r * P - (fb_real)j * Q) / (fb_real)(j + 1);
        Q = P;
        P = N;
      }
      slope = (fb_real)n * (Q - r * P) / (FB_R(1.0) - r * r);
      r -= P / slope;
    }

    /* From -1..1 to 0..1 */
    x[i] = FB_R(0.5) * (FB_R(1.0) + r);
    w[i] = FB_R(1.0) / ((FB_R(1.0) - r * r) * slope * slope);
  }
}
#endif

typedef struct fbi_field { /* linear displacement field at a point of the reference line, element axes */
  fb_real u[3];            /* displacement */
  fb_real theta[3];        /* section rotation */
  fb_real slope[2];        /* u_y', u_z': theta_z, -theta_y and the shear angles */
  fb_real strain;          /* u_x' */
  fb_real curvature[3];    /* theta' */
  fb_real strain_slope;    /* u_x''; element functions only */
} fbi_field;

/* [E6.1] Two-node beam element: cubic Hermite bending in two planes, linear axial displacement and torsion.
   u_y = N1 u_y1 + N2 theta_z1 + N3 u_y2 + N4 theta_z2, theta_z = u_y', theta_y = -u_z', Euler-Bernoulli.
   Source: [H] C.1-17 with ERRATA.md H3 (sign of the slopes).  Shapes: e 12 nodal values, s = 0..1, element length l.
   Cost: 60 flops.  Fails: never.  Test: rigid_motion_of_an_element_gives_no_strain. */
static void fbi_field_eval(fbi_field *f, const fb_real e[12], fb_real s, fb_real l)
{
  const fb_real N1 = FB_R(1.0) + s * s * (FB_R(2.0) * s - FB_R(3.0)), N3 = FB_R(1.0) - N1;
  const fb_real N2 = l * s * (FB_R(1.0) + s * (s - FB_R(2.0))), N4 = l * s * s * (s - FB_R(1.0));
  const fb_real d3 = FB_R(6.0) * s * (FB_R(1.0) - s) / l; /* d1 = -d3 */
  const fb_real d2 = FB_R(1.0) + s * (FB_R(3.0) * s - FB_R(4.0)), d4 = s * (FB_R(3.0) * s - FB_R(2.0));
  const fb_real c3 = (FB_R(6.0) - FB_R(12.0) * s) / (l * l); /* c1 = -c3 */
  const fb_real c2 = (FB_R(6.0) * s - FB_R(4.0)) / l, c4 = (FB_R(6.0) * s - FB_R(2.0)) / l;
  f->u[0] = (FB_R(1.0) - s) * e[0] + s * e[6];
  f->u[1] = N1 * e[1] + N2 * e[5] + N3 * e[7] + N4 * e[11];
  f->u[2] = N1 * e[2] - N2 * e[4] + N3 * e[8] - N4 * e[10];
  f->theta[0] = (FB_R(1.0) - s) * e[3] + s * e[9];
  f->theta[1] = d3 * (e[2] - e[8]) + d2 * e[4] + d4 * e[10];
  f->theta[2] = d3 * (e[7] - e[1]) + d2 * e[5] + d4 * e[11];
  f->slope[0] = f->theta[2];
  f->slope[1] = -f->theta[1];
  f->strain = (e[6] - e[0]) / l;
  f->curvature[0] = (e[9] - e[3]) / l;
  f->curvature[1] = c3 * (e[2] - e[8]) + c2 * e[4] + c4 * e[10];
  f->curvature[2] = c3 * (e[7] - e[1]) + c2 * e[5] + c4 * e[11];
}

/* [E6.5] Internal (bubble) shapes that vanish at both nodes (with their slopes, in bending), two per kind of motion:
   bending 16 s^2 (1-s)^2 (1, 4 (2s-1)), axial and torsion 4 s (1-s) (1, 2 (2s-1)). With them the frequencies converge
   with order 8 instead of 4 (bending) and 6 instead of 2: ten elements give the first modes to 1e-8, which cubics alone
   do not.
   Source: hierarchic (p-version) elements.  Shapes: b 8 amplitudes, two each of u_y, u_z, u_x, theta_x.
   Cost: 70 flops.  Fails: never.  Test: beam_frequencies_match_the_closed_form. */
static void fbi_field_add_internal(fbi_field *f, const fb_real b[8], fb_real s, fb_real l)
{
  const fb_real r = FB_R(2.0) * s - FB_R(1.0), p = s * (FB_R(1.0) - s); /* r' = 2, p' = -r */
  const fb_real u1 = FB_R(16.0) * p * p, u2 = FB_R(4.0) * r * u1;
  const fb_real d1 = -FB_R(32.0) * p * r / l, d2 = FB_R(4.0) * r * d1 + FB_R(8.0) * u1 / l;
  const fb_real c1 = FB_R(32.0) * (r * r - FB_R(2.0) * p) / (l * l);
  const fb_real c2 = FB_R(4.0) * r * c1 + FB_R(16.0) * d1 / l;
  const fb_real a1 = FB_R(4.0) * p, a2 = FB_R(2.0) * r * a1;
  const fb_real e1 = -FB_R(4.0) * r / l, e2 = FB_R(2.0) * r * e1 + FB_R(4.0) * a1 / l;
  f->u[0] += a1 * b[4] + a2 * b[5];
  f->u[1] += u1 * b[0] + u2 * b[1];
  f->u[2] += u1 * b[2] + u2 * b[3];
  f->theta[0] += a1 * b[6] + a2 * b[7];
  f->theta[1] -= d1 * b[2] + d2 * b[3];
  f->theta[2] += d1 * b[0] + d2 * b[1];
  f->slope[0] += d1 * b[0] + d2 * b[1];
  f->slope[1] += d1 * b[2] + d2 * b[3];
  f->strain += e1 * b[4] + e2 * b[5];
  f->curvature[0] += e1 * b[6] + e2 * b[7];
  f->curvature[1] -= c1 * b[2] + c2 * b[3];
  f->curvature[2] += c1 * b[0] + c2 * b[1];
}

/* [E6.9] Shear angles gamma_y, gamma_z of an element, each a cubic sum of g_k P_k(2s-1), P_k the Legendre polynomials:
   theta_z = u_y' - gamma_y, theta_y = -u_z' + gamma_z. The nodal values stay section rotations, so the Hermite slopes
   gain the end values of gamma; a constant gamma is the classical Timoshenko element. With the internal shapes E6.5
   the rotations have degree 4, as much as the displacements allow: no locking, and the order stays 8.
   Source: Timoshenko kinematics.  Shapes: g 8 amplitudes, four of gamma_y, four of gamma_z.  Cost: 60 flops.
   Fails: never.  Test: timoshenko_beams_have_the_published_frequencies. */
static void fbi_field_add_shear(fbi_field *f, const fb_real g[8], fb_real s, fb_real l)
{
  const fb_real r = FB_R(2.0) * s - FB_R(1.0), r2 = r * r;
  const fb_real P[4] = {FB_R(1.0), r, FB_R(0.5) * (FB_R(3.0) * r2 - FB_R(1.0)),
                        FB_R(0.5) * r * (FB_R(5.0) * r2 - FB_R(3.0))};
  const fb_real D[4] = {FB_R(0.0), FB_R(1.0), FB_R(3.0) * r, FB_R(0.5) * (FB_R(15.0) * r2 - FB_R(3.0))};
  const fb_real N2 = l * s * (FB_R(1.0) + s * (s - FB_R(2.0))), N4 = l * s * s * (s - FB_R(1.0));
  const fb_real d2 = FB_R(1.0) + s * (FB_R(3.0) * s - FB_R(4.0)), d4 = s * (FB_R(3.0) * s - FB_R(2.0));
  const fb_real c2 = (FB_R(6.0) * s - FB_R(4.0)) / l, c4 = (FB_R(6.0) * s - FB_R(2.0)) / l;

  /* u, d, c: Hermite shapes that carry the end values of P_k; section rotation = slope - gamma */
  for (int k = 0; k < 4; k++) {
    const fb_real sign = k % 2 ? -FB_R(1.0) : FB_R(1.0); /* P_k(-1) */
    const fb_real u = sign * N2 + N4, d = sign * d2 + d4, c = sign * c2 + c4;
    const fb_real rate = FB_R(2.0) * D[k] / l;
    f->u[1] += u * g[k];
    f->u[2] += u * g[4 + k];
    f->slope[0] += d * g[k];
    f->slope[1] += d * g[4 + k];
    f->theta[1] -= (d - P[k]) * g[4 + k];
    f->theta[2] += (d - P[k]) * g[k];
    f->curvature[1] -= (c - rate) * g[4 + k];
    f->curvature[2] += (c - rate) * g[k];
  }
}

#define FBI_DEGREE 8 /* highest degree of element functions: their mass is exact with 9 Gauss points */
#define FBI_FUNCTIONS (FBI_DEGREE + 1) /* functions in an element: 4 Hermite cubics and degree - 3 bubbles */
typedef struct fbi_functions {         /* element functions at a point, derivatives in x */
  fb_real value[FBI_FUNCTIONS], slope[FBI_FUNCTIONS], curvature[FBI_FUNCTIONS];
} fbi_functions;

/* [E6.7] Scalar functions with continuous slope: the four Hermite cubics of an element and the bubbles
   16 s^2 (1-s)^2 P_j(2s-1), P_j the Legendre polynomials.
   Source: hierarchic (p-version) elements.  Shapes: degree + 1 functions.  Cost: 20 flops each.  Fails: never.
   Test: functions_are_orthonormal_and_as_smooth_as_they_claim. */
static void fbi_functions_eval(fbi_functions *f, fb_real s, fb_real l, int degree)
{
  const fb_real r = FB_R(2.0) * s - FB_R(1.0), p = s * (FB_R(1.0) - s); /* p' = -r */
  const fb_real b = FB_R(16.0) * p * p, b1 = -FB_R(32.0) * p * r, b2 = FB_R(32.0) * (r * r - FB_R(2.0) * p);
  fb_real P = FB_R(1.0), P1 = FB_R(0.0), P2 = FB_R(0.0); /* P_j and its derivatives */
  fb_real Q = FB_R(0.0), Q1 = FB_R(0.0), Q2 = FB_R(0.0); /* those of P_(j-1) */

  /* Hermite cubics */
  f->value[2] = s * s * (FB_R(3.0) - FB_R(2.0) * s);
  f->value[0] = FB_R(1.0) - f->value[2];
  f->value[1] = l * s * (FB_R(1.0) + s * (s - FB_R(2.0)));
  f->value[3] = l * s * s * (s - FB_R(1.0));
  f->slope[2] = FB_R(6.0) * p / l;
  f->slope[0] = -f->slope[2];
  f->slope[1] = FB_R(1.0) + s * (FB_R(3.0) * s - FB_R(4.0));
  f->slope[3] = s * (FB_R(3.0) * s - FB_R(2.0));
  f->curvature[2] = -FB_R(6.0) * r / (l * l);
  f->curvature[0] = -f->curvature[2];
  f->curvature[1] = (FB_R(6.0) * s - FB_R(4.0)) / l;
  f->curvature[3] = (FB_R(6.0) * s - FB_R(2.0)) / l;

  /* Bubbles b P_j by the three-term recurrence; N is P_(j+1) */
  for (int j = 0; j + 3 < degree; j++) {
    const fb_real a = (fb_real)(2 * j + 1) / (fb_real)(j + 1), c = (fb_real)j / (fb_real)(j + 1);
    const fb_real N = a * r * P - c * Q, N1 = a * (P + r * P1) - c * Q1, N2 = a * (FB_R(2.0) * P1 + r * P2) - c * Q2;
    f->value[4 + j] = b * P;
    f->slope[4 + j] = (b1 * P + FB_R(2.0) * b * P1) / l;
    f->curvature[4 + j] = (b2 * P + FB_R(4.0) * (b1 * P1 + b * P2)) / (l * l);
    Q = P, Q1 = P1, Q2 = P2;
    P = N, P1 = N1, P2 = N2;
  }
}

/* Index of element function k among all: values and slopes of the nodes first, then the bubbles of each element. */
static int fbi_function_dof(int n_element, int degree, int element, int k)
{
  return k < 4 ? 2 * element + k : 2 * (n_element + 1) + (degree - 3) * element + k - 4;
}

static int fbi_function_ndof(int n_element, int degree)
{
  return 2 * (n_element + 1) + (degree - 3) * n_element;
}

#define FBI_SECTION ((int)(sizeof(fb_section) / sizeof(fb_real))) /* all its members are reals */
FB_DEF void fb_beam_section_eval(const fb_beam *beam, fb_section *section, fb_real x)
{
  FBI_REQUIRE(section && beam, );
  const fb_section *st = beam->desc.station;
  const int last = beam->desc.n_station - 1;
  int k = 0;
  fb_real s, a[FBI_SECTION], b[FBI_SECTION];

  /* Stations k and k + 1 around x; constant beyond the ends */
  while (k < last && x > st[k + 1].x) {
    k++;
  }
  if (k == last || x <= st[k].x) {
    *section = st[k];
    section->x = x;
    return;
  }

  /* Linear interpolation of all members */
  s = (x - st[k].x) / (st[k + 1].x - st[k].x);
  memcpy(a, &st[k], sizeof a);
  memcpy(b, &st[k + 1], sizeof b);
  for (int i = 0; i < FBI_SECTION; i++) {
    a[i] += s * (b[i] - a[i]);
  }
  memcpy(section, a, sizeof a);
  section->x = x;
}

/* [E6.10] Sections of one material. Saint-Venant torsion constant of a rectangle a >= b,
   J = a b^3 (1/3 - 64/pi^5 b/a sum_odd tanh(k pi a / 2b) / k^5); shear factors 10 (1+nu)/(12+11 nu) and, with m =
   inner/outer, 6 (1+nu)(1+m^2)^2 / ((7+6 nu)(1+m^2)^2 + (20+12 nu) m^2), nu = E/2G - 1.
   Source: Timoshenko and Goodier, Theory of Elasticity, 109; Cowper, J. Appl. Mech. 33, 1966.  Fails: see the header.
   Shapes: sizes of a profile.  Test: sections_from_dimensions_match_the_handbook. */
static void fbi_section_fill(fb_section *s, const fb_material *m, fb_real A, fb_real I_y, fb_real I_z, fb_real J,
                             fb_real shear_factor)
{
  s->mass = m->density * A;
  s->EA = m->E * A;
  s->EI_y = m->E * I_y;
  s->EI_z = m->E * I_z;
  s->GJ = m->G * J;
  s->GA_y = s->GA_z = shear_factor * m->G * A;
  s->i_y = m->density * I_y;
  s->i_z = m->density * I_z;
}

static void fbi_rectangle_fill(fb_section *s, const fb_material *m, fb_real y, fb_real z)
{
  const fb_real pi = FB_R(3.14159265358979324), nu = FB_R(0.5) * m->E / m->G - FB_R(1.0);
  const fb_real a = fbi_larger(y, z), b = y + z - a, A = a * b;
  fb_real sum = FB_R(1.00452376279513962); /* sum of 1/k^5, k odd */
  for (int k = 1; k < 12; k += 2) {        /* adds (tanh - 1)/k^5, negligible from k = 13 on */
    const fb_real q = FB_EXP(-(fb_real)k * pi * a / b), k2 = (fb_real)(k * k);
    sum -= FB_R(2.0) * q / ((FB_R(1.0) + q) * k2 * k2 * (fb_real)k);
  }
  sum *= FB_R(64.0) / (pi * pi * pi * pi * pi);
  fbi_section_fill(s, m, A, A * z * z / FB_R(12.0), A * y * y / FB_R(12.0),
                   A * b * b * (FB_R(1.0) / FB_R(3.0) - sum * b / a),
                   FB_R(10.0) * (FB_R(1.0) + nu) / (FB_R(12.0) + FB_R(11.0) * nu));
}

static void fbi_tube_fill(fb_section *s, const fb_material *m, fb_real outer, fb_real inner)
{
  const fb_real A = FB_R(3.14159265358979324) * (outer - inner) * (outer + inner);
  const fb_real I = FB_R(0.25) * A * (outer * outer + inner * inner);
  const fb_real nu = FB_R(0.5) * m->E / m->G - FB_R(1.0), m2 = inner * inner / (outer * outer);
  const fb_real p = (FB_R(1.0) + m2) * (FB_R(1.0) + m2);
  fbi_section_fill(s, m, A, I, I, FB_R(2.0) * I,
                   FB_R(6.0) * (FB_R(1.0) + nu) * p /
                       ((FB_R(7.0) + FB_R(6.0) * nu) * p + (FB_R(20.0) + FB_R(12.0) * nu) * m2));
}

static void fbi_profile_fill(fb_section *s, const fb_material *m, const fb_profile *profile)
{
  memset(s, 0, sizeof *s);
  s->x = profile->x;
  if (profile->kind == FB_PROFILE_TUBE) {
    fbi_tube_fill(s, m, profile->size[0], profile->size[1]);
  } else {
    fbi_rectangle_fill(s, m, profile->size[0], profile->size[1]);
  }
}

FB_DEF fb_status fb_section_init(fb_section *section, const fb_material *material, const fb_profile *profile)
{
  fb_section out;
  fb_real all[FBI_SECTION];
  FBI_REQUIRE(section && material && profile, FB_ERR_NULL);
  {
    const fb_real *size = profile->size;
    const fb_real given[6] = {material->E, material->G, material->density, profile->x, size[0], size[1]};
    const int tube = profile->kind == FB_PROFILE_TUBE;
    const fbi_number field[] = {
        FBI_NOT_NEGATIVE(&material->E, 1, "material.E [Pa]"), FBI_NOT_NEGATIVE(&material->G, 1, "material.G [Pa]"),
        FBI_NOT_NEGATIVE(&material->density, 1, "material.density [kg/m^3]"), FBI_ANY(&profile->x, 1, "profile.x [m]"),
        FBI_NOT_NEGATIVE(size, 2, "profile.size [m]")};
    const fbi_claim claim[] = {
        FBI_CLAIM(material->E > FB_R(0.0), "material.E [Pa], not 0"),
        FBI_CLAIM(material->G > FB_R(0.0), "material.G [Pa], not 0"),
        FBI_CLAIM(size[0] > FB_R(0.0), "profile.size[0] [m], not 0"),
        FBI_CLAIM(tube || profile->kind == FB_PROFILE_RECTANGLE, "profile.kind, an fb_profile_kind"),
        FBI_CLAIM(!tube || size[1] < size[0], "profile.size[1] [m] of a tube, below size[0]"),
        FBI_CLAIM(tube || size[1] > FB_R(0.0), "profile.size[1] [m] of a rectangle, not 0")};
    fb_status status = fbi_numbers_check(field, FBI_LENGTH(field), -1);
    status = status ? status : fbi_claims_check(claim, FBI_LENGTH(claim), -1);
    if (status != FB_OK || !fbi_is_finite(given, 6)) {
      return fbi_is_finite(given, 6) ? status : FB_ERR_NOT_FINITE;
    }
  }

  /* The results are checked, too: they may overflow */
  fbi_profile_fill(&out, material, profile);
  memcpy(all, &out, sizeof all);
  if (!fbi_is_finite(all, FBI_SECTION)) {
    return FB_ERR_NOT_FINITE;
  }
  *section = out;
  return FB_OK;
}

/* Section p at station k of the n of a taper: sizes interpolated linearly, the last of them those of `to` itself. */
static void fbi_taper_section(fb_real p[FBI_SECTION], const fb_material *material, const fb_profile *from,
                              const fb_profile *to, int k, int n)
{
  const fb_real s = (fb_real)k / (fb_real)(n - 1);
  fb_profile profile = *from;
  fb_section section;
  for (int i = 0; i < 2; i++) {
    profile.size[i] += s * (to->size[i] - from->size[i]);
  }
  fbi_profile_fill(&section, material, k == n - 1 ? to : &profile);
  memcpy(p, &section, sizeof section);
}

/* p -= h^2/12 p'' at station k, h^2 p'' = p_m-1 - 2 p_m + p_m+1 with m = k, at an end its neighbor. A thin end is
   lowered by half at most. Two stations have no second difference. */
static void fbi_taper_lower(fb_real p[FBI_SECTION], const fb_material *material, const fb_profile *from,
                            const fb_profile *to, int k, int n)
{
  const int m = k == 0 ? 1 : k == n - 1 ? n - 2 : k;
  fb_real before[FBI_SECTION], middle[FBI_SECTION], after[FBI_SECTION];
  if (n < 3) {
    return;
  }
  fbi_taper_section(before, material, from, to, m - 1, n);
  fbi_taper_section(middle, material, from, to, m, n);
  fbi_taper_section(after, material, from, to, m + 1, n);
  for (int i = 0; i < FBI_SECTION; i++) {
    const fb_real less = (before[i] - FB_R(2.0) * middle[i] + after[i]) / FB_R(12.0), most = FB_R(0.5) * p[i];
    p[i] -= less < most ? less : most;
  }
}

/* [E6.14] Stations of a linear taper: properties p(x) lowered by h^2/12 p'', so that linear interpolation between
   stations has the integral of p.
   Source: error of the trapezoidal rule.  Fails: see the header.  Test: tapered_beam_has_the_published_frequencies. */
FB_DEF fb_status fb_beam_desc_add_taper(fb_beam_desc *desc, const fb_material *material, const fb_profile *from,
                                        const fb_profile *to, int n)
{
  fb_section first, last;
  fb_status status;
  int at;
  FBI_REQUIRE(desc && material && from && to, FB_ERR_NULL);

  /* Both profiles are valid, of one kind and in order */
  status = fb_section_init(&first, material, from);
  status = status ? status : fb_section_init(&last, material, to);
  if (status != FB_OK) {
    return status;
  }
  {
    const fbi_claim claim[] = {FBI_CLAIM(n >= 2, "n, at least 2"),
                               FBI_CLAIM(from->kind == to->kind, "profile.kind, the same at both ends"),
                               FBI_CLAIM(to->x > from->x, "to.x [m], above from.x"),
                               FBI_CLAIM(desc->n_station >= 0, "desc.n_station, not negative")};
    status = fbi_claims_check(claim, FBI_LENGTH(claim), -1);
    if (status != FB_OK) {
      return status;
    }
  }

  /* The first new station replaces a last one at or beyond its place */
  at = desc->n_station;
  if (at > 0 && at <= FB_MAX_STATIONS && desc->station[at - 1].x >= from->x) {
    at--;
  }
  if (n > FB_MAX_STATIONS || at > FB_MAX_STATIONS - n) {
    return FBI_REFUSE(FB_ERR_CAPACITY, "count of stations with those of the desc, FB_MAX_STATIONS, at most", -1,
                      (fb_real)at + (fb_real)n, FB_R(1.0) * FB_MAX_STATIONS);
  }

  /* New stations at equal distances */
  for (int k = 0; k < n; k++) {
    fb_real p[FBI_SECTION];
    fbi_taper_section(p, material, from, to, k, n);
    fbi_taper_lower(p, material, from, to, k, n);
    memcpy(&desc->station[at + k], p, sizeof p);
    desc->station[at + k].x = from->x + (fb_real)k / (fb_real)(n - 1) * (to->x - from->x);
  }
  desc->station[at + n - 1].x = to->x;
  desc->n_station = at + n;
  return FB_OK;
}

static fb_real fbi_element_length(const fb_beam *beam, int element)
{
  return beam->start[element + 1] - beam->start[element];
}

/* Rotation matrix from element axes to body axes. */
static void fbi_element_axes(fb_real axes[9], const fb_beam *beam, int element)
{
  fb_mat33_mul(axes, beam->axes, beam->frame + 9 * element);
}

typedef struct fbi_cell { /* integration interval: in one element, between two stations (sections linear in x) */
  int element;
  fb_real x0, x1; /* [m] */
} fbi_cell;

/* Next integration interval, starting from {0, 0, 0}; returns 0 after the last. */
static int fbi_cell_next(fbi_cell *cell, const fb_beam *beam)
{
  fb_real gap = FB_R(1e-6) * fbi_element_length(beam, cell->element); /* shorter intervals are skipped */
  fb_real end;
  cell->x0 = cell->x1;
  if (cell->x0 >= beam->start[cell->element + 1] - gap) {
    cell->element++;
  }
  if (cell->element >= beam->desc.n_element) {
    return 0;
  }
  gap = FB_R(1e-6) * fbi_element_length(beam, cell->element);
  end = beam->start[cell->element + 1];
  cell->x1 = end;
  for (int k = 0; k < beam->desc.n_station; k++) {
    const fb_real x = beam->desc.station[k].x;
    if (x > cell->x0 + gap && x < end - gap && x < cell->x1) {
      cell->x1 = x;
    }
  }
  return 1;
}

static int fbi_cell_is_last(const fbi_cell *cell, const fb_beam *beam)
{
  fbi_cell next = *cell;
  return !fbi_cell_next(&next, beam);
}

/* Element coordinate s = 0..1 of the fraction t of an integration interval. */
static fb_real fbi_cell_s(const fbi_cell *cell, const fb_beam *beam, fb_real t)
{
  return (cell->x0 + t * (cell->x1 - cell->x0) - beam->start[cell->element]) / fbi_element_length(beam, cell->element);
}

/* Second moments of mass int r r^T dm = 1/2 tr(J) 1 - J; inertia holds the entries xx, yy, zz, xy, xz, yz of J. */
static void fbi_second_moments(fb_real S[9], const fb_real inertia[6])
{
  const fb_real half = FB_R(0.5) * (inertia[0] + inertia[1] + inertia[2]);
  S[0] = half - inertia[0];
  S[4] = half - inertia[1];
  S[8] = half - inertia[2];
  S[1] = S[3] = -inertia[3];
  S[2] = S[6] = -inertia[4];
  S[5] = S[7] = -inertia[5];
}

#define FBI_WORD_INERTIA "inertia [kg m^2], that of a body of positive mass (no moment above the sum of the others)"

/* [E6.2] Directions of spread of a rigid body: three vectors s_k with int r r^T dm = sum s_k s_k^T (semidefinite
   Cholesky, the largest diagonal element first), so that integrals of degree 2 over the body become sums. Rods and
   plates are the semidefinite cases.
   Source: [GV] 4.2.  Fails: the inertia is not one of a distribution of positive mass.
   Test: lumped_bodies_must_have_a_physical_inertia. */
static fb_status fbi_spread(fb_real s[3][3], const fb_real inertia[6])
{
  fb_real S[9], tol;
  fbi_second_moments(S, inertia);
  tol = FBI_ROUNDING * (FB_FABS(inertia[0]) + FB_FABS(inertia[1]) + FB_FABS(inertia[2]));
  for (int k = 0; k < 3; k++) {
    /* Pivot: the largest diagonal element left */
    const int p = S[0] >= S[4] ? (S[0] >= S[8] ? 0 : 2) : (S[4] >= S[8] ? 1 : 2);
    const fb_real pivot = S[4 * p];

    /* s_k, then S -= s_k s_k^T */
    for (int i = 0; i < 3; i++) {
      s[k][i] = pivot > tol ? S[3 * p + i] / FB_SQRT(pivot) : FB_R(0.0);
    }
    for (int i = 0; i < 3; i++) {
      for (int j = 0; j < 3; j++) {
        S[3 * i + j] -= s[k][i] * s[k][j];
      }
    }
  }
  for (int i = 0; i < 9; i++) { /* what is left is round-off, or the inertia was unphysical */
    if (!(FB_FABS(S[i]) <= FB_R(4.0) * tol)) {
      return FB_ERR_VALUE;
    }
  }
  return FB_OK;
}

/* Values of a section: finite, not negative, consistent. bent: the beam is a chain of points. k: number of the
   station. */
static fb_status fbi_section_check(const fb_section *s, int bent, int k)
{
  const fbi_number field[] = {FBI_ANY(&s->x, 1, "station: x [m]"),
                              FBI_NOT_NEGATIVE(&s->mass, 1, "station: mass [kg/m]"),
                              FBI_NOT_NEGATIVE(&s->EA, 1, "station: EA [N]"),
                              FBI_NOT_NEGATIVE(&s->GJ, 1, "station: GJ [N m^2]"),
                              FBI_NOT_NEGATIVE(&s->EI_y, 1, "station: EI_y [N m^2]"),
                              FBI_NOT_NEGATIVE(&s->EI_z, 1, "station: EI_z [N m^2]"),
                              FBI_NOT_NEGATIVE(&s->i_y, 1, "station: i_y [kg m]"),
                              FBI_NOT_NEGATIVE(&s->i_z, 1, "station: i_z [kg m]"),
                              FBI_NOT_NEGATIVE(&s->GA_y, 1, "station: GA_y [N]"),
                              FBI_NOT_NEGATIVE(&s->GA_z, 1, "station: GA_z [N]"),
                              FBI_ANY(&s->twist, 1, "station: twist [rad]"),
                              FBI_ANY(&s->mass_y, 1, "station: mass_y [m]"),
                              FBI_ANY(&s->mass_z, 1, "station: mass_z [m]"),
                              FBI_ANY(&s->tension_y, 1, "station: tension_y [m]"),
                              FBI_ANY(&s->tension_z, 1, "station: tension_z [m]"),
                              FBI_ANY(&s->shear_y, 1, "station: shear_y [m]"),
                              FBI_ANY(&s->shear_z, 1, "station: shear_z [m]")};
  const int turned = FB_FABS(s->twist) > FB_R(0.0), sheared = s->GA_y > FB_R(0.0);
  const int soft_y = s->EI_y > FB_R(0.0), soft_z = s->EI_z > FB_R(0.0);
  const fbi_claim claim[] = {
      FBI_CLAIM(!turned || soft_y == soft_z, "station: EI_y, EI_z [N m^2] of a twisted section, both 0 or neither"),
      /* in a chain all kinds of motion are coupled: none may be rigid */
      FBI_CLAIM(!bent || (s->EA > FB_R(0.0) && s->GJ > FB_R(0.0) && soft_y && soft_z),
                "station: EA, GJ, EI_y, EI_z of a beam by points, none 0"),
      FBI_CLAIM(sheared == (s->GA_z > FB_R(0.0)), "station: GA_y, GA_z [N], both 0 or neither"),
      FBI_CLAIM(sheared || !(FB_FABS(s->shear_y) + FB_FABS(s->shear_z) > FB_R(0.0)),
                "station: shear_y, shear_z [m], 0 without GA_y, GA_z")};
  fb_real all[FBI_SECTION];
  fb_status status = fbi_numbers_check(field, FBI_LENGTH(field), k);
  memcpy(all, s, sizeof all);
  status = fbi_is_finite(all, FBI_SECTION) ? status : FB_ERR_NOT_FINITE;
  return status ? status : fbi_claims_check(claim, FBI_LENGTH(claim), k);
}

static fb_status fbi_stations_check(const fb_beam_desc *desc)
{
  for (int k = 0; k < desc->n_station; k++) {
    const fb_status status = fbi_section_check(&desc->station[k], desc->n_point > 0, k);
    if (status != FB_OK) {
      return status;
    }
    if (k > 0 && !(desc->station[k].x > desc->station[k - 1].x)) {
      return FBI_REFUSE(FB_ERR_VALUE, "station: x [m] after that of the station before, above", k, desc->station[k].x,
                        desc->station[k - 1].x);
    }
    if (k > 0 && (desc->station[k].GA_y > FB_R(0.0)) != (desc->station[0].GA_y > FB_R(0.0))) {
      return FBI_REFUSE(FB_ERR_VALUE, "station: GA_y [N], 0 everywhere or nowhere, as of the first, equal to", k,
                        desc->station[k].GA_y, desc->station[0].GA_y);
    }
  }
  if (desc->n_station > 1) { /* slack: the length of a chain is a sum of square roots */
    const fb_real slack = (desc->n_point > 0 ? FB_R(1e-5) : FBI_ROUNDING) * desc->length;
    const int last = desc->n_station - 1;
    if (FB_FABS(desc->station[0].x) > slack) {
      return FBI_REFUSE(FB_ERR_VALUE, "station: x [m] of the first, equal to", 0, desc->station[0].x, FB_R(0.0));
    }
    if (FB_FABS(desc->station[last].x - desc->length) > slack) {
      return FBI_REFUSE(FB_ERR_VALUE, "station: x [m] of the last, the length, equal to", last, desc->station[last].x,
                        desc->length);
    }
  }
  return FB_OK;
}

/* [E6.11] Shortest rotation that takes the unit vector a to b, R = 1 + v^ + v^ v^ / (1 + a.b), v = a x b.
   Source: Rodrigues.  Cost: 40 flops.  Fails: opposite vectors.  Test: a_chain_follows_its_points. */
static void fbi_shortest_turn(fb_real R[9], const fb_real a[3], const fb_real b[3])
{
  const fb_real c = fb_vec3_dot(a, b);
  fb_real v[3];
  fb_vec3_cross(v, a, b);
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      R[3 * i + j] = v[i] * v[j] / (FB_R(1.0) + c) + (i == j ? c : FB_R(0.0));
    }
  }
  R[1] -= v[2];
  R[2] += v[1];
  R[3] += v[2];
  R[5] -= v[0];
  R[6] -= v[1];
  R[7] += v[0];
}

/* Nodes, lengths and axes of the elements: equal elements along x, or the chain through the desc's points. */
static fb_status fbi_line_fill(fb_beam *beam)
{
  const fb_beam_desc *desc = &beam->desc;
  const fb_real l = desc->length / (fb_real)desc->n_element;
  fb_real along[3] = {FB_R(1.0), FB_R(0.0), FB_R(0.0)};
  fb_real frame[9] = {FB_R(1.0), FB_R(0.0), FB_R(0.0), FB_R(0.0), FB_R(1.0),
                      FB_R(0.0), FB_R(0.0), FB_R(0.0), FB_R(1.0)};
  memset(beam->node, 0, sizeof beam->node);
  beam->start[0] = FB_R(0.0);
  for (int e = 0; e < desc->n_element; e++) {
    if (desc->n_point == 0) {
      beam->start[e + 1] = (fb_real)(e + 1) * l;
      beam->node[3 * (e + 1)] = beam->start[e + 1];
    } else {
      fb_real chord[3], turn[9], length;
      fbi_copy(beam->node + 3 * (e + 1), desc->point[e + 1], 3);
      fbi_copy(chord, desc->point[e + 1], 3);
      fbi_vec3_add(chord, -FB_R(1.0), desc->point[e]);

      /* Unit chord; kinks of 90 deg and more are refused, as is a first chord (nearly) opposite to x */
      length = fbi_vec3_norm(chord);
      if (!(length > FB_R(0.0))) {
        return FBI_REFUSE(FB_ERR_VALUE, "point: distance [m] from the one before, above", e + 1, length, FB_R(0.0));
      }
      for (int i = 0; i < 3; i++) {
        chord[i] /= length;
      }
      if (!(fb_vec3_dot(along, chord) > (e == 0 ? -FB_R(0.99) : FB_R(0.0)))) {
        return FBI_REFUSE(FB_ERR_VALUE, "point: cosine of the kink before it (of the first: against x), above", e + 1,
                          fb_vec3_dot(along, chord), e == 0 ? -FB_R(0.99) : FB_R(0.0));
      }

      /* Frame: that of the previous element, rotated by the shortest rotation */
      fbi_shortest_turn(turn, along, chord);
      fb_mat33_mul(beam->frame + 9 * e, turn, frame);
      fbi_copy(frame, beam->frame + 9 * e, 9);
      fbi_copy(along, chord, 3);
      beam->start[e + 1] = beam->start[e] + length;
    }
    fbi_copy(beam->frame + 9 * e, frame, 9);
  }
  return FB_OK;
}

static fb_status fbi_lumps_check(const fb_lump *lumps, int n, int last_node)
{
  for (int k = 0; k < n; k++) {
    const fb_lump *lump = &lumps[k];
    fb_real spread[3][3];
    const fbi_number field[] = {FBI_ANY(&lump->mass, 1, "lump: mass [kg]"),
                                FBI_ANY(lump->center, 3, "lump: center [m]"),
                                FBI_ANY(lump->inertia, 6, "lump: inertia [kg m^2]")};
    const fbi_count count[] = {FBI_COUNT(lump->node, 0, last_node, "lump: node, beyond")};
    fb_status status = fbi_numbers_check(field, FBI_LENGTH(field), k);
    status = status ? status : fbi_counts_check(FB_ERR_CAPACITY, count, FBI_LENGTH(count), k);
    if (status != FB_OK) {
      return status;
    }
    if (!(lump->mass >= FB_R(0.0))) {
      return FBI_REFUSE(FB_ERR_VALUE, "lump: mass [kg], at least", k, lump->mass, FB_R(0.0));
    }
    if (fbi_spread(spread, lump->inertia) != FB_OK) {
      return FBI_REFUSE(FB_ERR_VALUE, "lump: " FBI_WORD_INERTIA, k, FB_R(0.0), FB_R(0.0));
    }
  }
  return FB_OK;
}

/* Counts, finite values and ranges of a desc; its line and stations are checked later. */
static fb_status fbi_beam_desc_check(const fb_beam_desc *desc)
{
  const int straight = desc->n_point == 0;
  const fbi_count most[] = {FBI_AT_MOST(desc->n_element, FB_MAX_ELEMENTS, "n_element, FB_MAX_ELEMENTS"),
                            FBI_AT_MOST(desc->n_station, FB_MAX_STATIONS, "n_station, FB_MAX_STATIONS"),
                            FBI_AT_MOST(desc->n_lump, FB_MAX_LUMPS, "n_lump, FB_MAX_LUMPS"),
                            FBI_AT_MOST(desc->n_point, FB_MAX_ELEMENTS + 1, "n_point, FB_MAX_ELEMENTS + 1")};
  const fbi_number field[] = {FBI_ANY(&desc->length, 1, "length [m]"), FBI_ANY(desc->position, 3, "position [m]"),
                              FBI_ANY(desc->attitude, 4, "attitude")};
  const fbi_count least[] = {FBI_AT_LEAST(desc->n_element, 1, "n_element"),
                             FBI_AT_LEAST(desc->n_station, 1, "n_station"), FBI_AT_LEAST(desc->n_lump, 0, "n_lump"),
                             FBI_COUNT((int)desc->root, 0, (int)FB_ROOT_COUNT - 1, "root, an fb_root, beyond"),
                             FBI_COUNT(desc->n_point, straight ? 0 : desc->n_element + 1,
                                       straight ? 0 : desc->n_element + 1,
                                       "n_point, one more than n_element, equal to")};
  fb_status status = fbi_counts_check(FB_ERR_CAPACITY, most, FBI_LENGTH(most), -1);
  status = status ? status : fbi_numbers_check(field, FBI_LENGTH(field), -1);
  for (int k = 0; k < desc->n_point && status == FB_OK; k++) {
    const fbi_number point[] = {FBI_ANY(desc->point[k], 3, "point: coordinates [m]")};
    status = fbi_numbers_check(point, 1, k);
  }
  status = status ? status : fbi_counts_check(FB_ERR_VALUE, least, FBI_LENGTH(least), -1);
  if (status == FB_OK && straight && !(desc->length > FB_R(0.0))) {
    return FBI_REFUSE(FB_ERR_VALUE, "length [m], above", -1, desc->length, FB_R(0.0));
  }
  if (status == FB_OK && !straight && fbi_vec3_norm(desc->point[0]) > FB_R(0.0)) {
    return FBI_REFUSE(FB_ERR_VALUE, "point: distance [m] of the first from the origin, equal to", 0,
                      fbi_vec3_norm(desc->point[0]), FB_R(0.0));
  }
  return status;
}

static fb_real fbi_beam_mass(const fb_beam *beam)
{
  fbi_cell cell = {0, FB_R(0.0), FB_R(0.0)};
  fb_real mass = FB_R(0.0);
  while (fbi_cell_next(&cell, beam)) {
    for (int g = 0; g < FBI_GAUSS; g++) {
      fb_section section;
      fb_beam_section_eval(beam, &section, cell.x0 + fbi_gauss_x[g] * (cell.x1 - cell.x0));
      mass += fbi_gauss_w[g] * (cell.x1 - cell.x0) * section.mass;
    }
  }
  for (int k = 0; k < beam->desc.n_lump; k++) {
    mass += beam->desc.lump[k].mass;
  }
  return mass;
}

/* Zeroes the table entries beyond the counts. */
static void fbi_desc_clear(fb_beam_desc *desc)
{
  memset(desc->station + desc->n_station, 0, sizeof desc->station[0] * (size_t)(FB_MAX_STATIONS - desc->n_station));
  memset(desc->lump + desc->n_lump, 0, sizeof desc->lump[0] * (size_t)(FB_MAX_LUMPS - desc->n_lump));
  memset(desc->point + desc->n_point, 0, sizeof desc->point[0] * (size_t)(FB_MAX_ELEMENTS + 1 - desc->n_point));
}

FB_DEF fb_status fb_beam_init(fb_beam *beam, const fb_beam_desc *desc)
{
  fb_beam checked;
  fb_real quat[4];
  fb_status status;
  FBI_REQUIRE(beam && desc, FB_ERR_NULL);
  FBI_REQUIRE_EXACT();
  status = fbi_beam_desc_check(desc);
  if (status != FB_OK) {
    return status;
  }

  /* Elements along the line */
  memset(&checked, 0, sizeof checked);
  checked.desc = *desc;
  fbi_desc_clear(&checked.desc);
  checked.has_shear = desc->station[0].GA_y > FB_R(0.0);
  status = fbi_quat_from_attitude(quat, desc->attitude);
  status = status ? status : fbi_line_fill(&checked);
  if (status != FB_OK) {
    return status;
  }

  /* Stations and lumped bodies, against the length of the line */
  checked.desc.length = desc->n_point > 0 ? checked.start[desc->n_element] : desc->length;
  if (desc->n_station == 1) {
    checked.desc.station[0].x = FB_R(0.0);
  }
  status = fbi_stations_check(&checked.desc);
  status = status ? status : fbi_lumps_check(desc->lump, desc->n_lump, desc->n_element);
  if (status != FB_OK) {
    return status;
  }

  /* Axes and mass */
  fb_quat_to_mat33(checked.axes, quat);
  checked.mass = fbi_beam_mass(&checked);
  if (!(checked.mass > FB_R(0.0))) {
    return FBI_REFUSE(FB_ERR_VALUE, "mass [kg] of all stations and lumps, above", -1, checked.mass, FB_R(0.0));
  }
  *beam = checked;
  return FB_OK;
}

/* Number of degrees of freedom: six per node, then eight internal ones per element, then eight of shear, if any. */
static int fbi_beam_ndof(const fb_beam *beam)
{
  return 6 * (beam->desc.n_element + 1) + (beam->has_shear ? 16 : 8) * beam->desc.n_element;
}

/* How K and M of a beam are stored. A coordinate is coupled with those of the nodes and elements next to it alone: a
   row holds three runs of successive columns, nodal ones and those of two blocks of internal ones, and is `width` long.
   Coordinates are numbered by nodes, then by the elements of block 0, then by those of block 1. */
typedef struct fbi_rows {
  int n_element, ndof, width;
  int nodal;       /* coordinates of a node: 6, of scalar functions 2 */
  int internal[2]; /* of an element, in each block */
  int full;        /* 1: a row holds all columns */
} fbi_rows;

typedef struct fbi_run {
  int first, n; /* columns first .. first + n - 1 */
  int at;       /* place of the first one in the row */
} fbi_run;

static fbi_rows fbi_rows_of(int n_element, int nodal, int internal, int shear)
{
  fbi_rows rows = {0, 0, 0, 0, {0, 0}, 0};
  rows.n_element = n_element;
  rows.nodal = nodal;
  rows.internal[0] = internal;
  rows.internal[1] = shear;
  rows.ndof = nodal * (n_element + 1) + (internal + shear) * n_element;
  rows.width = 3 * nodal + 2 * (internal + shear); /* a node has two neighbors and two elements */
  return rows;
}

/* All coordinates of a beam (fbi_beam_ndof). */
static fbi_rows fbi_beam_rows(const fb_beam *beam)
{
  return fbi_rows_of(beam->desc.n_element, 6, 8, beam->has_shear ? 8 : 0);
}

/* The runs of row i. */
static void fbi_row_runs(fbi_run run[3], const fbi_rows *rows, int i)
{
  const int n = rows->n_element, start = rows->nodal * (n + 1), second = start + rows->internal[0] * n;
  int from, to; /* elements from .. to - 1 hold coordinate i */
  if (i < start) {
    const int node = i / rows->nodal;
    from = node > 0 ? node - 1 : 0;
    to = node < n ? node + 1 : n;
  } else {
    const int per = i < second ? rows->internal[0] : rows->internal[1];
    from = per > 0 ? (i - (i < second ? start : second)) / per : 0;
    to = from + 1;
  }
  memset(run, 0, 3 * sizeof *run);
  if (rows->full) {
    run[0].n = rows->ndof;
    return;
  }
  run[0].first = rows->nodal * from;
  run[0].n = rows->nodal * (to - from + 1);
  for (int b = 0; b < 2; b++) {
    run[b + 1].first = (b ? second : start) + rows->internal[b] * from;
    run[b + 1].n = rows->internal[b] * (to - from);
    run[b + 1].at = 3 * rows->nodal + 2 * b * rows->internal[0];
  }
}

/* Place of element (i, j) of a stored matrix; i and j are coupled. */
static int fbi_row_place(const fbi_rows *rows, int i, int j)
{
  fbi_run run[3];
  int b = 2;
  fbi_row_runs(run, rows, i);
  while (b > 0 && (j < run[b].first || j >= run[b].first + run[b].n)) {
    b--;
  }
  return i * rows->width + run[b].at + j - run[b].first;
}

/* Row i of A with all its columns. */
static void fbi_row_get(fb_real *row, const fbi_rows *rows, const fb_real *A, int i)
{
  fbi_run run[3];
  fbi_row_runs(run, rows, i);
  fbi_zero(row, rows->ndof);
  for (int b = 0; b < 3; b++) {
    fbi_copy(row + run[b].first, A + i * rows->width + run[b].at, run[b].n);
  }
}

/* (A x)_i */
static fb_real fbi_row_dot(const fbi_rows *rows, const fb_real *A, int i, const fb_real *x)
{
  fbi_run run[3];
  fb_real sum = FB_R(0.0);
  fbi_row_runs(run, rows, i);
  for (int b = 0; b < 3; b++) {
    const fb_real *const a = A + i * rows->width + run[b].at;
    for (int j = 0; j < run[b].n; j++) {
      sum += a[j] * x[run[b].first + j];
    }
  }
  return sum;
}

/* The n rows and columns dof of A as a full matrix. */
static void fbi_rows_pick(fb_real *to, const fb_real *A, const fbi_rows *rows, const int *dof, int n)
{
  for (int i = 0; i < n; i++) {
    fb_real row[FBI_MAX_DOF];
    fbi_row_get(row, rows, A, dof[i]);
    for (int j = 0; j < n; j++) {
      to[i * n + j] = row[dof[j]];
    }
  }
}

/* Coordinates of an element: 12 nodal (beam axes), 8 internal and 8 of shear (element axes). */
#define FBI_LOCAL 28
/* Index of element coordinate k in the assembled matrices. */
static int fbi_element_dof(const fb_beam *beam, int element, int k)
{
  const int n = beam->desc.n_element;
  return k < 12 ? 6 * element + k : 6 * (n + 1) + (k < 20 ? 8 * element + k - 12 : 8 * n + 8 * element + k - 20);
}

/* Displacement field of an element at s from its coordinates v. */
static void fbi_element_field(fbi_field *f, const fb_beam *beam, int element, const fb_real v[FBI_LOCAL], fb_real s)
{
  const fb_real l = fbi_element_length(beam, element);
  fb_real e[12];
  for (int i = 0; i < 12; i += 3) {
    fb_mat33_mulT_vec3(e + i, beam->frame + 9 * element, v + i);
  }
  fbi_field_eval(f, e, s, l);
  fbi_field_add_internal(f, v + 12, s, l);
  if (beam->has_shear) {
    fbi_field_add_shear(f, v + 20, s, l);
  }
}

/* [E6.12] Generalized strains and displacements of a section in section axes (rotated by the twist): strain at the
   tension center, shear at the shear center, displacement of the mass center,
   eps_t = eps + z_t k_y - y_t k_z,  g_y = gamma_y - z_s k_x,  g_z = gamma_z + y_s k_x,  u_m = u + theta x (0, y_m,
   z_m).
   Source: u(x, y, z) = u + theta x (0, y, z).  Cost: 50 flops, sin, cos.  Fails: never.
   Test: offset_centers_bend_and_twist_as_in_statics, a_pretwisted_beam_bends_as_its_sections_turn. */
typedef struct fbi_section_field {
  fb_real strain, shear[2], curvature[3];
  fb_real u[3], theta[3];
  fb_real slope[2]; /* element axes */
} fbi_section_field;

/* Components of (y, z) in axes rotated by the twist. */
static void fbi_turn_yz(fb_real *y_out, fb_real *z_out, fb_real y, fb_real z, fb_real twist)
{
  const fb_real c = FB_COS(twist), s = FB_SIN(twist);
  *y_out = c * y + s * z;
  *z_out = c * z - s * y;
}

/* Section strains and displacements of a field (E6.12). */
static void fbi_section_eval(fbi_section_field *out, const fbi_field *f, const fb_section *s)
{
  const fb_real offset[3] = {FB_R(0.0), s->mass_y, s->mass_z};
  out->theta[0] = f->theta[0];
  out->curvature[0] = f->curvature[0];
  out->u[0] = f->u[0];
  fbi_turn_yz(&out->theta[1], &out->theta[2], f->theta[1], f->theta[2], s->twist);
  fbi_turn_yz(&out->curvature[1], &out->curvature[2], f->curvature[1], f->curvature[2], s->twist);
  fbi_turn_yz(&out->u[1], &out->u[2], f->u[1], f->u[2], s->twist);
  fbi_turn_yz(&out->shear[0], &out->shear[1], f->slope[0] - f->theta[2], f->slope[1] + f->theta[1], s->twist);
  out->strain = f->strain + s->tension_z * out->curvature[1] - s->tension_y * out->curvature[2];
  out->shear[0] -= s->shear_z * out->curvature[0];
  out->shear[1] += s->shear_y * out->curvature[0];
  fbi_vec3_add_cross(out->u, out->theta, offset);
  fbi_copy(out->slope, f->slope, 2);
}

/* Integrands of stiffness k and mass m of two fields at a section under a tension, per length (E6.3). */
static void fbi_field_products(fb_real *k, fb_real *m, const fbi_section_field *a, const fbi_section_field *b,
                               const fb_section *section, fb_real tension)
{
  *k = section->EA * a->strain * b->strain + section->GJ * a->curvature[0] * b->curvature[0] +
       section->EI_y * a->curvature[1] * b->curvature[1] + section->EI_z * a->curvature[2] * b->curvature[2] +
       section->GA_y * a->shear[0] * b->shear[0] + section->GA_z * a->shear[1] * b->shear[1] +
       tension * (a->slope[0] * b->slope[0] + a->slope[1] * b->slope[1]);
  *m = section->mass * fb_vec3_dot(a->u, b->u) + (section->i_y + section->i_z) * a->theta[0] * b->theta[0] +
       section->i_y * a->theta[1] * b->theta[1] + section->i_z * a->theta[2] * b->theta[2];
}

/* [E6.3] Element stiffness and consistent mass at one Gauss point, added to the assembled K and M; its term (i, j) is
   at place[i * n + j] there.
   K_ij += dx (EA e_i e_j + GJ k_x k_x + EI_y k_y k_y + EI_z k_z k_z + GA_y g_y g_y + GA_z g_z g_z + T (u_y' u_y' + u_z'
   u_z')),  M_ij += dx (mass u_i.u_j + (i_y + i_z) th_x th_x + i_y th_y th_y + i_z th_z th_z);
   T is the tension of a preload (geometric stiffness), the fields are those of E6.12.
   Source: [H] C.1-27, C.2-11.  Shapes: unit fields, n of them; place n x n.  Cost: n^2 x 30 flops.  Fails: never.
   Test: element_matrices_match_the_textbook_ones. */
static void fbi_element_add(fb_real *K, fb_real *M, const fbi_field *f, const int *place, const fb_section *section,
                            fb_real dx, fb_real tension, int n)
{
  fbi_section_field at[FBI_LOCAL];
  for (int i = 0; i < n; i++) {
    fbi_section_eval(&at[i], &f[i], section);
  }
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) {
      fb_real k, m;
      fbi_field_products(&k, &m, &at[i], &at[j], section, tension);
      K[place[i * n + j]] += dx * k;
      M[place[i * n + j]] += dx * m;
    }
  }
}

/* [E6.4] A lumped body in the mass matrix of its node: with u = u_n + theta x c,
   M += mass (u.u) + theta.J theta, J about the mass center.
   Source: rigid-body kinetic energy.  Shapes: M, the node's 6 x 6 block, its rows `stride` apart.  Fails: never.
   Test: tip_mass_lowers_the_frequencies_as_published. */
static void fbi_lump_add(fb_real *M, const fb_lump *lump, int stride)
{
  const fb_real *c = lump->center, *J = lump->inertia, m = lump->mass;
  const fb_real cross[9] = {FB_R(0.0), c[2], -c[1], -c[2],    FB_R(0.0),
                            c[0],      c[1], -c[0], FB_R(0.0)}; /* u += cross theta */
  const fb_real inertia[9] = {J[0], J[3], J[4], J[3], J[1], J[5], J[4], J[5], J[2]};
  for (int i = 0; i < 3; i++) {
    M[i * stride + i] += m;
    for (int j = 0; j < 3; j++) {
      fb_real steiner = FB_R(0.0);
      for (int k = 0; k < 3; k++) {
        steiner += cross[3 * k + i] * cross[3 * k + j];
      }
      M[i * stride + 3 + j] += m * cross[3 * i + j];
      M[(3 + j) * stride + i] += m * cross[3 * i + j];
      M[(3 + i) * stride + 3 + j] += inertia[3 * i + j] + m * steiner;
    }
  }
}

/* [E6.6] Tension of a preload: a tip force F, a field of acceleration a along x and a steady spin on all mass beyond x,
   T(x) = F + int_x^L mass (a + spin^2 (radius + xi)) dxi + the same of the lumped bodies beyond x.
   Source: [H] C.1 (static preload); equilibrium.  Cost: 30 flops a cell and Gauss point.  Fails: never.
   Test: spinning_beams_stiffen_as_published, columns_buckle_under_the_published_loads. */
static fb_real fbi_tension(const fb_beam *beam, fb_real x, const fb_preload *load)
{
  const fb_real spin2 = load->spin * load->spin;
  fb_real sum = load->force;
  fbi_cell cell = {0, FB_R(0.0), FB_R(0.0)};
  while (fbi_cell_next(&cell, beam)) {
    const fb_real x0 = fbi_larger(cell.x0, x);
    for (int g = 0; g < FBI_GAUSS && x0 < cell.x1; g++) {
      fb_section section;
      fb_beam_section_eval(beam, &section, x0 + fbi_gauss_x[g] * (cell.x1 - x0));
      sum += fbi_gauss_w[g] * (cell.x1 - x0) * section.mass *
             (load->acceleration + spin2 * (load->spin_radius + section.x));
    }
  }
  for (int k = 0; k < beam->desc.n_lump; k++) {
    const fb_lump *lump = &beam->desc.lump[k];
    const fb_real at = beam->start[lump->node];
    sum += at > x ? lump->mass * (load->acceleration + spin2 * (load->spin_radius + at + lump->center[0])) : FB_R(0.0);
  }
  return sum;
}

static int fbi_is_loaded(const fb_preload *load)
{
  return FB_FABS(load->force) + FB_FABS(load->acceleration) + FB_FABS(load->spin) > FB_R(0.0);
}

/* Element coordinates that static condensation eliminates (E6.13): the shear amplitudes, and the quadratic axial shape,
   without which bending about an offset tension center would be too stiff. */
#define FBI_CONDENSED 9
static int fbi_condensed_dofs(int dof[FBI_CONDENSED], const fb_beam *beam)
{
  int n = 0, offset = 0, elastic = 1;
  for (int k = 0; k < beam->desc.n_station; k++) {
    const fb_section *s = &beam->desc.station[k];
    offset = offset || FB_FABS(s->tension_y) + FB_FABS(s->tension_z) > FB_R(0.0);
    elastic = elastic && s->EA > FB_R(0.0);
  }
  if (offset && elastic) {
    dof[n++] = 16;
  }
  for (int k = 20; k < FBI_LOCAL && beam->has_shear; k++) {
    dof[n++] = k;
  }
  return n;
}

/* [E6.13] Static condensation: each nodal coordinate e of an element with the internal ones g = -K_gg^-1 K_ge e: the
   classical Timoshenko element, whose stiffness is exact for loads at its nodes.
   Source: static condensation; Przemieniecki 5.6.  Shapes: v 12 x FBI_LOCAL, row k for nodal coordinate k.
   Fails: never.
   Test: element_matrices_match_the_textbook_ones, offset_centers_bend_and_twist_as_in_statics. */
static void fbi_nodal_values(fb_real v[12 * FBI_LOCAL], const fb_beam *beam, int element)
{
  enum { N = 12 + FBI_CONDENSED };
  int internal[FBI_CONDENSED], place[N * N];
  const int m = fbi_condensed_dofs(internal, beam), n = 12 + m;
  fb_real K[N * N] = {FB_R(0.0)}, M[N * N] = {FB_R(0.0)}, Kgg[FBI_CONDENSED * FBI_CONDENSED], g[FBI_CONDENSED];
  fbi_cell cell = {0, FB_R(0.0), FB_R(0.0)};

  /* Stiffness of the nodal and the condensed coordinates */
  for (int ij = 0; ij < n * n; ij++) {
    place[ij] = ij;
  }
  while (m > 0 && fbi_cell_next(&cell, beam)) {
    for (int at = 0; at < FBI_GAUSS && cell.element == element; at++) {
      fb_section section;
      fbi_field f[N];
      for (int i = 0; i < n; i++) {
        fb_real unit[FBI_LOCAL] = {FB_R(0.0)};
        unit[i < 12 ? i : internal[i - 12]] = FB_R(1.0);
        fbi_element_field(&f[i], beam, element, unit, fbi_cell_s(&cell, beam, fbi_gauss_x[at]));
      }
      fb_beam_section_eval(beam, &section, cell.x0 + fbi_gauss_x[at] * (cell.x1 - cell.x0));
      fbi_element_add(K, M, f, place, &section, fbi_gauss_w[at] * (cell.x1 - cell.x0), FB_R(0.0), n);
    }
  }

  /* K_gg = L L^T */
  for (int i = 0; i < m * m; i++) {
    Kgg[i] = K[n * (12 + i / m) + 12 + i % m];
  }
  fbi_zero(v, 12 * FBI_LOCAL);
  (void)fb_chol_factor(Kgg, m); /* positive: GA > 0, EA > 0 */

  /* g = -K_gg^-1 K_ge e for each unit e */
  for (int k = 0; k < 12; k++) {
    v[k * FBI_LOCAL + k] = FB_R(1.0);
    for (int i = 0; i < m; i++) {
      g[i] = -K[n * (12 + i) + k];
    }
    fb_chol_solve(g, Kgg, g, m);
    for (int i = 0; i < m; i++) {
      v[k * FBI_LOCAL + internal[i]] = g[i];
    }
  }
}

/* Assembled K and M under a preload, in these rows: of all coordinates, or of the nodal ones after condensation, where
   the rows have no internal ones. */
static void fbi_matrices(fb_real *K, fb_real *M, const fbi_rows *rows, const fb_beam *beam, const fb_preload *load)
{
  const int loaded = fbi_is_loaded(load), nodal = rows->internal[0] == 0;
  const int n = nodal ? 12 : beam->has_shear ? FBI_LOCAL : 20;
  fb_real values[12 * FBI_LOCAL];
  int place[FBI_LOCAL * FBI_LOCAL], element = -1;
  fbi_cell cell = {0, FB_R(0.0), FB_R(0.0)};
  fbi_zero(K, rows->ndof * rows->width);
  fbi_zero(M, rows->ndof * rows->width);
  while (fbi_cell_next(&cell, beam)) {
    /* New element: places, condensed shapes */
    if (cell.element != element) {
      element = cell.element;
      for (int ij = 0; ij < n * n; ij++) {
        place[ij] = fbi_row_place(rows, fbi_element_dof(beam, element, ij / n), fbi_element_dof(beam, element, ij % n));
      }
      if (nodal) {
        fbi_nodal_values(values, beam, element);
      }
    }

    /* Quadrature: fields of unit coordinates, their products added */
    for (int g = 0; g < FBI_GAUSS; g++) {
      const fb_real x = cell.x0 + fbi_gauss_x[g] * (cell.x1 - cell.x0), dx = fbi_gauss_w[g] * (cell.x1 - cell.x0);
      const fb_real tension = loaded ? fbi_tension(beam, x, load) : FB_R(0.0);
      fb_section section;
      fbi_field f[FBI_LOCAL];
      for (int i = 0; i < n; i++) {
        fb_real unit[FBI_LOCAL] = {FB_R(0.0)};
        unit[i] = FB_R(1.0);
        fbi_element_field(&f[i], beam, element, nodal ? values + i * FBI_LOCAL : unit,
                          fbi_cell_s(&cell, beam, fbi_gauss_x[g]));
      }
      fb_beam_section_eval(beam, &section, x);
      fbi_element_add(K, M, f, place, &section, dx, tension, n);
    }
  }

  /* Lumped bodies */
  for (int k = 0; k < beam->desc.n_lump; k++) {
    const int at = 6 * beam->desc.lump[k].node;
    fbi_lump_add(M + fbi_row_place(rows, at, at), &beam->desc.lump[k], rows->width);
  }
}

FB_DEF void fb_beam_matrices_eval(const fb_beam *beam, fb_real *K, fb_real *M)
{
  const fb_preload none = {FB_R(0.0), FB_R(0.0), FB_R(0.0), FB_R(0.0)};
  fbi_rows rows;
  FBI_REQUIRE(K && M && beam, );
  rows = fbi_rows_of(beam->desc.n_element, 6, 0, 0);
  rows.width = rows.ndof;
  rows.full = 1;
  fbi_matrices(K, M, &rows, beam, &none);
}

/* ---------------------------------------------------------------------------------------------------------------
   BUILD >>modes: natural modes, components, buckling, synthesis (uses config, status, vec3, solve, eigen, beam) */

/* The coordinates of a beam are those of an assumed-modes (Ritz) basis: natural and attachment modes, Craig-Bampton
   component modes, finite-element coordinates or scalar functions. Names: kind, bending in a plane, axial or torsion;
   group, kinds that are coupled; held, constrained; work.found, the basis so far; weld, a rigid connection. */

/* Kind of motion (bending in two planes, axial, torsion) that a degree of freedom belongs to. */
static fb_kind fbi_dof_kind(const fb_beam *beam, int dof)
{
  static const fb_kind nodal[6] = {FB_KIND_AXIAL,   FB_KIND_BEND_Y, FB_KIND_BEND_Z,
                                   FB_KIND_TORSION, FB_KIND_BEND_Z, FB_KIND_BEND_Y};
  static const fb_kind internal[4] = {FB_KIND_BEND_Y, FB_KIND_BEND_Z, FB_KIND_AXIAL, FB_KIND_TORSION};
  const int n = beam->desc.n_element, at = dof - 6 * (n + 1);
  return at < 0 ? nodal[dof % 6] : at < 8 * n ? internal[at % 8 / 2] : internal[at % 8 / 4];
}

/* The nodal displacement that represents each kind. */
static const int fbi_kind_dof[FB_KIND_COUNT] = {1, 2, 0, 3};

/* Does the beam have stiffness and inertia of this kind? Otherwise it is rigid in that way. A chain has all kinds. */
static int fbi_kind_exists(const fb_beam *beam, fb_kind kind, const fb_real *M, const fbi_rows *rows)
{
  int stiff = 0, inert = 0;
  if (beam->desc.n_point > 0) {
    return 1;
  }
  for (int k = 0; k < beam->desc.n_station; k++) {
    const fb_section *s = &beam->desc.station[k];
    const fb_real stiffness[FB_KIND_COUNT] = {s->EI_z, s->EI_y, s->EA, s->GJ};
    stiff = stiff || stiffness[kind] > FB_R(0.0);
  }
  for (int i = 0; i < rows->ndof; i++) {
    inert = inert || (fbi_dof_kind(beam, i) == kind && M[fbi_row_place(rows, i, i)] > FB_R(0.0));
  }
  return stiff && inert;
}

/* Groups of kinds that K or M couple (twist, centers and lumped bodies off the axis, kinks), numbered by their first
   kind; -1: the kind does not exist. */
static void fbi_kind_groups(int group[FB_KIND_COUNT], const fb_beam *beam, const fb_real *K, const fb_real *M)
{
  const fbi_rows rows = fbi_beam_rows(beam);
  for (int k = 0; k < FB_KIND_COUNT; k++) {
    group[k] = fbi_kind_exists(beam, (fb_kind)k, M, &rows) ? k : -1;
  }
  for (int i = 0; i < rows.ndof; i++) {
    fb_real row_K[FBI_MAX_DOF], row_M[FBI_MAX_DOF];
    fbi_row_get(row_K, &rows, K, i);
    fbi_row_get(row_M, &rows, M, i);
    for (int j = 0; j < rows.ndof; j++) {
      const int a = group[fbi_dof_kind(beam, i)], b = group[fbi_dof_kind(beam, j)];
      if (a >= 0 && b >= 0 && a != b && FB_FABS(row_M[j]) + FB_FABS(row_K[j]) > FB_R(0.0)) {
        for (int k = 0; k < FB_KIND_COUNT; k++) {
          group[k] = group[k] == (a > b ? a : b) ? (a < b ? a : b) : group[k];
        }
      }
    }
  }
}

/* Does the root condition constrain this degree of freedom? */
static int fbi_is_held(const fb_beam *beam, int dof)
{
  return dof < 6 && (beam->desc.root == FB_ROOT_CLAMPED || (beam->desc.root == FB_ROOT_PINNED && dof < 4));
}

static int fbi_coordinate_dof(const fb_coordinate *c)
{
  return 6 * c->node + c->axis;
}

/* Degrees of freedom of a group that are not constrained; returns their number. */
static int fbi_group_dofs(int *dof, const fb_beam *beam, const int *held, const int group[FB_KIND_COUNT], int id)
{
  const int ndof = fbi_beam_ndof(beam);
  int n = 0;
  for (int i = 0; i < ndof; i++) {
    if (group[fbi_dof_kind(beam, i)] == id && !held[i]) {
      dof[n++] = i;
    }
  }
  return n;
}

/* The six rigid-body displacements about the root, three translations and three rotations, in rows of ndof. */
static void fbi_rigid_fill(fb_real *rigid, const fb_beam *beam)
{
  const int ndof = fbi_beam_ndof(beam);
  fbi_zero(rigid, 6 * ndof);
  for (int node = 0; node <= beam->desc.n_element; node++) {
    for (int i = 0; i < 3; i++) {
      fb_real axis[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)};
      axis[i] = FB_R(1.0);
      rigid[i * ndof + 6 * node + i] = FB_R(1.0);
      rigid[(3 + i) * ndof + 6 * node + 3 + i] = FB_R(1.0);
      fb_vec3_cross(rigid + (3 + i) * ndof + 6 * node, axis, beam->node + 3 * node);
    }
  }
}

/* [E7.6] Rigid-body modes of a group: combinations of the six rigid motions that vanish at all coordinates but the free
   ones of the group, null space of their values there (rotations times the length). Row k of motion combines the six.
   Source: linear algebra.  Shapes: motion 6 x 6.  Cost: E5.3 with n = 6.  Fails: never.
   Test: beam_frequencies_match_the_closed_form (free and pinned roots), components_keep_their_rigid_motions. */
static int fbi_rigid_motions(fb_real motion[36], const fb_modes_work *work, const fb_beam *beam,
                             const int group[FB_KIND_COUNT], int id)
{
  const int ndof = fbi_beam_ndof(beam), nodal = 6 * (beam->desc.n_element + 1);
  const fb_real L = beam->desc.length;
  fb_real G[36] = {FB_R(0.0)}, d[6];
  int n = 0;

  /* G: Gram matrix of the six motions at the coordinates that must not move */
  for (int i = 0; i < nodal; i++) {
    const fb_real unit = i % 6 < 3 ? FB_R(1.0) : L;
    if (group[fbi_dof_kind(beam, i)] == id && !work->held[i]) {
      continue;
    }
    for (int ab = 0; ab < 36; ab++) {
      const int a = ab / 6, b = ab % 6;
      const fb_real x = work->rigid[a * ndof + i] * (a < 3 ? FB_R(1.0) : FB_R(1.0) / L);
      const fb_real y = work->rigid[b * ndof + i] * (b < 3 ? FB_R(1.0) : FB_R(1.0) / L);
      G[ab] += unit * unit * x * y;
    }
  }

  /* Null space: eigenvalues of zero, rotations scaled back */
  (void)fb_eig_sym_solve(d, motion, G, 6);
  while (n < 6 && d[n] < FBI_ROUNDING) {
    for (int a = 3; a < 6; a++) {
      motion[6 * n + a] /= L;
    }
    n++;
  }
  return n;
}

/* [E7.1] Shift of an eigenproblem with rigid-body modes: the Rayleigh quotient of the displacement (x/L)^2 in all kinds
   of the group, a fraction of the lowest elastic eigenvalue.
   Source: own.  Fails: never.  Test: beam_frequencies_match_the_closed_form (free and pinned roots). */
static fb_real fbi_shift(const fb_beam *beam, const fb_real *Kc, const fb_real *Mc, const int *dof, int n)
{
  const fb_real L = beam->desc.length;
  fb_real k = FB_R(0.0), m = FB_R(0.0);
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) {
      fb_real y[2];
      for (int side = 0; side < 2; side++) {
        const int at = dof[side ? j : i];
        const fb_real x = at < 6 * (beam->desc.n_element + 1) ? beam->start[at / 6] / L : FB_R(0.0);
        y[side] = at % 6 < 4 ? L * x * x : (at % 6 == 4 ? -FB_R(2.0) : FB_R(2.0)) * x;
      }
      k += y[0] * Kc[i * n + j] * y[1];
      m += y[0] * Mc[i * n + j] * y[1];
    }
  }
  return k / m;
}

/* Reverses the order of n eigenvalues and rows of eigenvectors. */
static void fbi_eig_turn(fb_real *d, fb_real *X, int n)
{
  for (int k = 0; k < n / 2; k++) {
    fbi_swap(d + k, d + n - 1 - k, 1);
    fbi_swap(X + k * n, X + (n - 1 - k) * n, n);
  }
}

/* [E7.2] Natural modes of a group as the LARGEST eigenvalues of M x = mu (K + shift M) x, omega^2 = 1/mu - shift:
   the low modes, the wanted ones, keep all digits (also in single precision) and massless coordinates are harmless.
   Source: [GV] 8.7.  Shapes: work.X rows of n, work.omega2 ascending.  Fails: as E5.4.
   Test: beam_frequencies_match_the_closed_form. */
static fb_status fbi_group_solve(const fb_beam *beam, fb_modes_work *work, const int *dof, int n, int rigid, int *found)
{
  const fbi_rows rows = fbi_beam_rows(beam);
  fb_real shift;
  fb_status status;

  /* K and M of the group, K shifted where there are rigid-body modes */
  fbi_rows_pick(work->A, work->K, &rows, dof, n);
  fbi_rows_pick(work->X, work->M, &rows, dof, n);
  shift = rigid > 0 ? fbi_shift(beam, work->A, work->X, dof, n) : FB_R(0.0);
  for (int i = 0; i < n * n; i++) {
    work->A[i] += shift * work->X[i];
  }

  /* M x = mu (K + shift M) x */
  status = fbi_eig_gen_solve(work->omega2, work->X, work->A, n);
  if (status != FB_OK) {
    return status;
  }

  /* Modes with inertia: mu above round-off */
  *found = 0;
  for (int k = n - 1; k >= 0 && work->omega2[k] > (fb_real)n * FB_EPSILON * work->omega2[n - 1]; k--) {
    (*found)++;
  }

  /* omega^2 = 1/mu - shift, ascending */
  fbi_eig_turn(work->omega2, work->X, n);
  for (int k = 0; k < *found; k++) {
    work->omega2[k] = FB_R(1.0) / work->omega2[k] - shift;
  }
  return FB_OK;
}

/* a^T M b of full-length shapes; M may be the stiffness matrix. */
static fb_real fbi_modal_product(const fb_real *a, const fb_real *M, const fb_real *b, const fbi_rows *rows)
{
  fb_real sum = FB_R(0.0);
  for (int i = 0; i < rows->ndof; i++) {
    if (FB_FABS(a[i]) > FB_R(0.0)) {
      sum += a[i] * fbi_row_dot(rows, M, i, b);
    }
  }
  return sum;
}

/* Kind with the largest share of a shape's kinetic energy. */
static fb_kind fbi_shape_kind(const fb_beam *beam, const fb_real *shape, const fb_real *M)
{
  const fbi_rows rows = fbi_beam_rows(beam);
  fb_real share[FB_KIND_COUNT] = {0};
  int best = 0;
  for (int i = 0; i < rows.ndof; i++) {
    share[fbi_dof_kind(beam, i)] += shape[i] * fbi_row_dot(&rows, M, i, shape);
  }
  for (int k = 1; k < FB_KIND_COUNT; k++) {
    best = share[k] > share[best] ? k : best;
  }
  return (fb_kind)best;
}

/* Makes x M-orthogonal to the m M-orthonormal rows of f (Gram-Schmidt). */
static void fbi_orthogonalize(fb_real *x, const fb_real *f, const fb_real *M, int m, const fbi_rows *rows)
{
  for (int twice = 0; twice < 2; twice++) { /* the second pass removes round-off */
    for (int k = 0; k < m; k++) {
      const fb_real share = fbi_modal_product(f + k * rows->ndof, M, x, rows);
      for (int i = 0; i < rows->ndof; i++) {
        x[i] -= share * f[k * rows->ndof + i];
      }
    }
  }
}

/* Scales shape k, whose modal mass is given, to modal mass 1 and a positive tip displacement of its kind. */
static void fbi_shape_scale(fb_modes *modes, int k, fb_real mass, int n_element)
{
  const int main_dof = fbi_kind_dof[modes->kind[k]];
  fb_real *x = modes->shape + k * modes->ndof;
  fb_real scale, sign = x[6 * n_element + main_dof], largest = FB_R(0.0);
  for (int i = main_dof; i < 6 * (n_element + 1); i += 6) {
    largest = FB_FABS(x[i]) > FB_FABS(largest) ? x[i] : largest;
  }
  if (FB_FABS(sign) < FB_R(1e-3) * FB_FABS(largest)) { /* tip at a node (heavy tip body): largest value */
    sign = largest;
  }
  scale = (sign < FB_R(0.0) ? -FB_R(1.0) : FB_R(1.0)) / FB_SQRT(mass);
  for (int i = 0; i < modes->ndof; i++) {
    x[i] *= scale;
  }
}

/* [E7.3] Mass normalization, x^T M x = 1, orthogonal to the shapes before it, tip displacement of its kind positive.
   Returns 0 if no more than `share` of its modal mass remains then: it depends linearly on those before.
   Source: convention.  Shapes: rows of ndof.  Fails: never.  Test: modes_are_orthonormal_with_a_fixed_sign. */
static int fbi_shape_normalize(fb_modes *modes, int k, const fb_real *M, const fb_beam *beam, fb_real share)
{
  const fbi_rows rows = fbi_beam_rows(beam);
  fb_real *x = modes->shape + k * rows.ndof;
  const fb_real before = fbi_modal_product(x, M, x, &rows);
  fb_real mass;
  fbi_orthogonalize(x, modes->shape, M, k, &rows);
  mass = fbi_modal_product(x, M, x, &rows);
  if (!(mass > share * before)) {
    return 0;
  }
  fbi_shape_scale(modes, k, mass, beam->desc.n_element);
  return 1;
}

/* Full-length shape of mode k of a solved group with the n coordinates dof. */
static void fbi_group_shape(fb_real *shape, const fb_modes_work *work, const int *dof, int k, int n, int ndof)
{
  fbi_zero(shape, ndof);
  for (int i = 0; i < n; i++) {
    shape[dof[i]] = work->X[k * n + i];
  }
}

/* [E7.7] Effective mass of a mode along a rigid motion r of the root, (x^T M r)^2 / (r^T M r): those of all modes
   of a clamped beam add up to its mass but for that at the root ([DB] (43)). Returns whether the modes found reach the
   fraction asked for along each motion that the group's free coordinates take part in and whose kind is asked for.
   Source: Hughes, by [DB] 5.1.  Cost: 2 ndof^2 flops a mode and motion.  Fails: never.
   Test: effective_masses_add_up_to_the_beam. */
static int fbi_mass_is_reached(const fb_modes_desc *desc, const fb_modes_work *work, const fb_beam *beam,
                               const int *dof, int n)
{
  static const fb_kind kind[6] = {FB_KIND_AXIAL,   FB_KIND_BEND_Y, FB_KIND_BEND_Z,
                                  FB_KIND_TORSION, FB_KIND_BEND_Z, FB_KIND_BEND_Y};
  const fb_modes *found = &work->found;
  const fbi_rows rows = fbi_beam_rows(beam);
  for (int i = 0; i < 6; i++) {
    const fb_real *r = work->rigid + i * found->ndof;
    fb_real sum = FB_R(0.0), root[36] = {FB_R(0.0)};

    /* Does the group take part in motion i? */
    int moves = 0;
    for (int j = 0; j < n; j++) {
      moves = moves || FB_FABS(r[dof[j]]) > FB_R(0.0);
    }

    /* Inertia of lumped bodies at the clamped root, which modes cannot move */
    for (int k = 0; k < beam->desc.n_lump; k++) {
      if (beam->desc.lump[k].node == 0) {
        fbi_lump_add(root, &beam->desc.lump[k], 6);
      }
    }

    /* Effective mass of the modes found against that of the beam without the root */
    for (int k = 0; k < found->n && moves && desc->count[kind[i]] > 0; k++) {
      const fb_real share = fbi_modal_product(found->shape + k * found->ndof, work->M, r, &rows);
      sum += share * share;
    }
    if (moves && desc->count[kind[i]] > 0 && sum < desc->mass_fraction * (found->rigid_mass[i] - root[7 * i])) {
      return 0;
    }
  }
  return 1;
}

typedef struct fbi_choice { /* which modes to take */
  const int *count;         /* per kind */
  int most;                 /* and no more than these in all */
  fb_real limit;            /* [rad/s] 0: none */
} fbi_choice;

/* Takes modes first..last - 1 of a solved group with the n coordinates dof into work.found, as far as the choice and
   the mass fraction allow. A shape in the span of earlier ones (modes at a spin) is skipped. */
static fb_status fbi_group_take(const fb_modes_desc *desc, fb_modes_work *work, const fb_beam *beam, const int *dof,
                                int n, int first, int last, int taken[FB_KIND_COUNT], const fbi_choice *choice)
{
  fb_modes *out = &work->found;
  const int by_mass = desc->mass_fraction > FB_R(0.0);
  fb_real spare[FBI_MAX_DOF];
  for (int k = first; k < last && out->n < choice->most; k++) {
    const fb_real omega = FB_SQRT(fbi_larger(work->omega2[k], FB_R(0.0)));
    fb_kind kind;

    /* Frequency limit or mass fraction reached */
    if ((choice->limit > FB_R(0.0) && omega > choice->limit) ||
        (by_mass && fbi_mass_is_reached(desc, work, beam, dof, n))) {
      return FB_OK;
    }

    /* Candidate shape; skipped if there are enough of its kind */
    fbi_group_shape(spare, work, dof, k, n, out->ndof);
    kind = fbi_shape_kind(beam, spare, work->M);
    if (taken[kind] >= choice->count[kind]) {
      continue;
    }

    /* Taken unless it depends linearly on the others */
    if (out->n == FB_MAX_MODES) {
      return FB_ERR_CAPACITY;
    }
    fbi_copy(out->shape + out->n * out->ndof, spare, out->ndof);
    out->kind[out->n] = kind;
    out->omega[out->n] = omega;
    if (fbi_shape_normalize(out, out->n, work->M, beam, FB_SQRT(FB_EPSILON))) {
      taken[kind]++;
      out->n++;
    }
  }
  return by_mass && !fbi_mass_is_reached(desc, work, beam, dof, n) ? FB_ERR_MODES : FB_OK;
}

/* Sorts modes by frequency, equal ones by kind. */
static void fbi_modes_sort(fb_modes *modes)
{
  for (int i = 1; i < modes->n && i < FB_MAX_MODES; i++) {
    for (int k = i; k > 0 && (modes->omega[k] < modes->omega[k - 1] ||
                              (modes->omega[k] <= modes->omega[k - 1] && modes->kind[k] < modes->kind[k - 1]));
         k--) {
      const fb_real omega = modes->omega[k];
      const fb_kind kind = modes->kind[k];
      modes->omega[k] = modes->omega[k - 1];
      modes->omega[k - 1] = omega;
      modes->kind[k] = modes->kind[k - 1];
      modes->kind[k - 1] = kind;
      for (int j = 0; j < modes->ndof; j++) {
        const fb_real x = modes->shape[k * modes->ndof + j];
        modes->shape[k * modes->ndof + j] = modes->shape[(k - 1) * modes->ndof + j];
        modes->shape[(k - 1) * modes->ndof + j] = x;
      }
    }
  }
}

/* Basis of finite-element coordinates: unit nodal displacements of the kinds asked for, with the condensed internal
   coordinates (E6.13). */
static fb_status fbi_elements_take(const fb_modes_desc *desc, fb_modes_work *work, const fb_beam *beam,
                                   const int group[FB_KIND_COUNT])
{
  const fbi_rows rows = fbi_rows_of(beam->desc.n_element, 6, 0, 0);
  fb_modes *out = &work->found;
  int dof[FBI_MAX_DOF];

  /* One coordinate per free nodal displacement */
  for (int i = 0; i < rows.ndof; i++) {
    const fb_kind kind = fbi_dof_kind(beam, i);
    if (desc->count[kind] > 0 && group[kind] >= 0 && !work->held[i]) {
      if (out->n == FB_MAX_MODES) {
        return FB_ERR_CAPACITY;
      }
      fbi_zero(out->shape + out->n * out->ndof, out->ndof);
      out->shape[out->n * out->ndof + i] = FB_R(1.0);
      out->kind[out->n] = kind;
      out->omega[out->n] = FB_R(0.0);
      dof[out->n] = i;
      out->n++;
    }
  }

  /* Internal coordinates that follow it in each element */
  for (int e = 0; e < beam->desc.n_element; e++) {
    fb_real v[12 * FBI_LOCAL];
    fbi_nodal_values(v, beam, e);
    for (int a = 0; a < out->n; a++) {
      const int k = dof[a] - 6 * e;
      for (int i = 12; i < (beam->has_shear ? FBI_LOCAL : 20) && k >= 0 && k < 12; i++) {
        out->shape[a * out->ndof + fbi_element_dof(beam, e, i)] = v[k * FBI_LOCAL + i];
      }
    }
  }

  /* M and K of the condensed elements, assembled where eigenproblems are solved */
  fbi_matrices(work->A, work->X, &rows, beam, &desc->preload);
  fbi_rows_pick(out->K, work->A, &rows, dof, out->n);
  fbi_rows_pick(out->M, work->X, &rows, dof, out->n);
  return FB_OK;
}

/* Solves group id, with n coordinates dof: `found` modes, the first `rigid` of which are rigid-body modes. */
static fb_status fbi_group_open(int *dof, int *n, int *rigid, int *found, fb_modes_work *work, const fb_beam *beam,
                                const int group[FB_KIND_COUNT], int id)
{
  fb_real motion[36];
  *n = group[id] == id ? fbi_group_dofs(dof, beam, work->held, group, id) : 0;
  *rigid = *found = 0;
  if (*n == 0) {
    return FB_OK;
  }
  *rigid = fbi_rigid_motions(motion, work, beam, group, id);
  return fbi_group_solve(beam, work, dof, *n, *rigid, found);
}

/* How many of the n lowest elastic modes each group has; equal ones at the end of the list go to the first group.
   Lowers limit to the frequency of the n-th; unchanged if there are fewer modes. */
static fb_status fbi_lowest_limit(fb_real *limit, int share[FB_KIND_COUNT], fb_modes_work *work, const fb_beam *beam,
                                  const int group[FB_KIND_COUNT], int lowest)
{
  fb_real list[FB_MAX_MODES] = {0};
  int owner[FB_MAX_MODES] = {0}, dof[FBI_MAX_DOF], filled = 0;
  for (int id = 0; id < FB_KIND_COUNT; id++) {
    int n, rigid, found;
    const fb_status status = fbi_group_open(dof, &n, &rigid, &found, work, beam, group, id);
    if (status != FB_OK) {
      return status;
    }

    /* Insertion into the list of the lowest frequencies */
    for (int k = rigid; k < found; k++) {
      const fb_real omega = FB_SQRT(fbi_larger(work->omega2[k], FB_R(0.0)));
      int at = filled < lowest ? filled : lowest;
      for (; at > 0 && omega < list[at - 1]; at--) {
        if (at < lowest) {
          list[at] = list[at - 1];
          owner[at] = owner[at - 1];
        }
      }
      if (at < lowest) {
        list[at] = omega;
        owner[at] = id;
        filled += filled < lowest;
      }
    }
  }

  for (int k = 0; k < filled; k++) {
    share[owner[k]]++;
  }

  /* Limit, where the list is full */
  if (filled == lowest && (!(*limit > FB_R(0.0)) || list[lowest - 1] < *limit)) {
    *limit = list[lowest - 1];
  }
  return FB_OK;
}

/* Solves every group with the present work.K and work.M; takes up to count modes per kind, or the lowest of all. */
static fb_status fbi_modes_take(const fb_modes_desc *desc, fb_modes_work *work, const fb_beam *beam,
                                const int group[FB_KIND_COUNT], int taken[FB_KIND_COUNT],
                                const int count[FB_KIND_COUNT])
{
  static const int all[FB_KIND_COUNT] = {FB_ALL_MODES, FB_ALL_MODES, FB_ALL_MODES, FB_ALL_MODES};
  fbi_choice choice = {count, FB_MAX_MODES + 1, desc->omega_limit};
  int share[FB_KIND_COUNT] = {0}, dof[FBI_MAX_DOF];

  /* The lowest of all kinds: a share of each group and a frequency limit in place of counts */
  if (desc->lowest > 0) {
    fb_status status;
    if (desc->lowest > FB_MAX_MODES - work->found.n) {
      return FB_ERR_CAPACITY;
    }
    status = fbi_lowest_limit(&choice.limit, share, work, beam, group, desc->lowest);
    if (status != FB_OK) {
      return status;
    }
    choice.count = all;
  }

  /* Modes of each group */
  for (int id = 0; id < FB_KIND_COUNT; id++) {
    int n, rigid, found;
    fb_status status = fbi_group_open(dof, &n, &rigid, &found, work, beam, group, id);
    choice.most = desc->lowest > 0 ? work->found.n + share[id] : choice.most;
    if (status == FB_OK && n > 0) {
      status = fbi_group_take(desc, work, beam, dof, n, rigid, found, taken, &choice);
    }
    if (status != FB_OK) {
      return status;
    }
  }
  return FB_OK;
}

/* [E7.4] Ritz modes of the unloaded beam in the span of the shapes found: K x = omega^2 x with M = 1 in that basis,
   so that modes at rest and modes at a spin together give diagonal matrices again. work.K is the unloaded stiffness.
   Source: Rayleigh-Ritz.  Shapes: n shapes of ndof.  Fails: as E5.3.  Test: spinning_beams_stiffen_as_published. */
static fb_status fbi_modes_ritz(fb_modes_work *work, const fb_beam *beam)
{
  const fbi_rows rows = fbi_beam_rows(beam);
  fb_modes *out = &work->found;
  const int n = out->n, ndof = out->ndof;
  fb_status status;

  /* Eigenvectors of the reduced stiffness Phi^T K Phi */
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) {
      work->A[i * n + j] = fbi_modal_product(out->shape + i * ndof, work->K, out->shape + j * ndof, &rows);
    }
  }
  status = fb_eig_sym_solve(work->omega2, work->X, work->A, n);
  if (status != FB_OK) {
    return status;
  }

  /* Ritz modes X Phi in place of Phi, by columns */
  for (int i = 0; i < ndof; i++) {
    fb_real column[FB_MAX_MODES];
    for (int k = 0; k < n; k++) {
      column[k] = FB_R(0.0);
      for (int j = 0; j < n; j++) {
        column[k] += work->X[k * n + j] * out->shape[j * ndof + i];
      }
    }
    for (int k = 0; k < n; k++) {
      out->shape[k * ndof + i] = column[k];
    }
  }
  for (int k = 0; k < n; k++) {
    out->omega[k] = FB_SQRT(fbi_larger(work->omega2[k], FB_R(0.0)));
    out->kind[k] = fbi_shape_kind(beam, out->shape + k * ndof, work->M);
    (void)fbi_shape_normalize(out, k, work->M, beam, FB_R(0.0));
  }
  return FB_OK;
}

/* All elastic coordinates that are not constrained; returns their number. */
static int fbi_elastic_dofs(int *dof, const fb_modes_work *work, const fb_beam *beam, const int group[FB_KIND_COUNT])
{
  const int ndof = fbi_beam_ndof(beam);
  int n = 0;
  for (int i = 0; i < ndof; i++) {
    if (group[fbi_dof_kind(beam, i)] >= 0 && !work->held[i]) {
      dof[n++] = i;
    }
  }
  return n;
}

/* Cholesky factor, in work.A, of the stiffness of all elastic coordinates that are not constrained; returns their
   number. */
static int fbi_static_factor(fb_status *status, int *dof, fb_modes_work *work, const fb_beam *beam,
                             const int group[FB_KIND_COUNT])
{
  const fbi_rows rows = fbi_beam_rows(beam);
  const int n = fbi_elastic_dofs(dof, work, beam, group);
  fbi_rows_pick(work->A, work->K, &rows, dof, n);
  *status = fb_chol_factor(work->A, n);
  return n;
}

/* x = K^-1 x over the n coordinates dof, zero elsewhere. */
static void fbi_static_solve(fb_real *x, const fb_modes_work *work, const int *dof, int n, int ndof)
{
  fb_real f[FBI_MAX_DOF] = {FB_R(0.0)};
  for (int i = 0; i < n; i++) {
    f[i] = x[dof[i]];
  }
  fb_chol_solve(f, work->A, f, n);
  fbi_zero(x, ndof);
  for (int i = 0; i < n; i++) {
    x[dof[i]] = f[i];
  }
}

static void fbi_shape_move(fb_modes *modes, int to, int from)
{
  memmove(modes->shape + to * modes->ndof, modes->shape + from * modes->ndof,
          (size_t)modes->ndof * sizeof *modes->shape);
  modes->kind[to] = modes->kind[from];
  modes->omega[to] = modes->omega[from];
}

/* Appends a full-length shape to those found; returns 0 if it depends linearly on them. */
static int fbi_shape_take(fb_modes_work *work, const fb_beam *beam, const fb_real *shape, fb_real omega)
{
  fb_modes *out = &work->found;
  fbi_copy(out->shape + out->n * out->ndof, shape, out->ndof);
  out->kind[out->n] = fbi_shape_kind(beam, shape, work->M);
  out->omega[out->n] = omega;
  if (!fbi_shape_normalize(out, out->n, work->M, beam, FBI_ROUNDING)) { /* corrections may be small */
    return 0;
  }
  out->n++;
  return 1;
}

/* Makes x M-orthogonal to the m rows of f and scales it to modal mass 1. */
static void fbi_orthonormalize(fb_real *x, const fb_real *f, const fb_real *M, int m, const fbi_rows *rows)
{
  fb_real norm;
  fbi_orthogonalize(x, f, M, m, rows);
  norm = FB_SQRT(fbi_modal_product(x, M, x, rows));
  for (int i = 0; i < rows->ndof; i++) {
    x[i] /= norm;
  }
}

/* Orthonormal rigid-body modes that the root condition allows, in work.free; returns their number. A motion without
   inertia is skipped. */
static int fbi_free_fill(fb_modes_work *work, const fb_beam *beam)
{
  static const int all[FB_KIND_COUNT] = {0, 0, 0, 0};
  const fbi_rows rows = fbi_beam_rows(beam);
  const int ndof = rows.ndof;
  fb_real motion[36];
  const int m = fbi_rigid_motions(motion, work, beam, all, 0);
  int n = 0;
  for (int k = 0; k < m; k++) {
    fb_real *x = work->free + n * ndof, before;
    fbi_zero(x, ndof);
    for (int ai = 0; ai < 6 * ndof; ai++) {
      x[ai % ndof] += motion[6 * k + ai / ndof] * work->rigid[ai];
    }
    before = fbi_modal_product(x, work->M, x, &rows);
    if (!(before > FB_R(0.0))) {
      continue;
    }
    fbi_orthonormalize(x, work->free, work->M, n, &rows);
    n += fbi_is_finite(x, ndof);
  }
  return n;
}

#define FBI_WORD_ROOM "count of modes, FB_MAX_MODES, at most"

/* Puts the n rigid-body modes of work.free in front of the modes found. */
static fb_status fbi_free_take(fb_modes_work *work, const fb_beam *beam, int n)
{
  fb_modes *out = &work->found;
  if (out->n > FB_MAX_MODES - n) {
    return FBI_REFUSE(FB_ERR_CAPACITY, FBI_WORD_ROOM, -1, (fb_real)(out->n + n), FB_R(1.0) * FB_MAX_MODES);
  }
  for (int k = out->n - 1; k >= 0; k--) {
    fbi_shape_move(out, k + n, k);
  }
  out->n += n;
  for (int k = 0; k < n; k++) {
    fbi_copy(out->shape + k * out->ndof, work->free + k * out->ndof, out->ndof);
    out->omega[k] = FB_R(0.0);
    out->kind[k] = fbi_shape_kind(beam, out->shape + k * out->ndof, work->M);
    fbi_shape_scale(out, k, FB_R(1.0), beam->desc.n_element);
  }
  return FB_OK;
}

/* [E7.8] Attachment modes with inertia relief: x = K^-1 (f - M R (R^T M R)^-1 R^T f) with the root clamped, f a unit
   load, R the rigid-body modes that the root allows; the root's reaction vanishes. Orthogonal to the modes kept, they
   are the residual flexibility: the deflection that those modes miss.
   Source: [H] 2.5; Craig, Structural Dynamics, 1981, 19 (inertia relief).  Fails: capacity; no stiffness there.
   Test: static_corrections_make_loads_exact. */
static fb_status fbi_static_take(const fb_modes_desc *desc, fb_modes_work *work, const fb_beam *beam,
                                 const int group[FB_KIND_COUNT], int n_free)
{
  const fbi_rows rows = fbi_beam_rows(beam);
  fb_modes *out = &work->found;
  int dof[FBI_MAX_DOF], n;
  fb_status status;

  /* Stiffness with the root clamped, whatever its condition; work.held is not needed afterwards */
  for (int i = 0; i < 6; i++) {
    work->held[i] = 1;
  }
  n = fbi_static_factor(&status, dof, work, beam, group);
  for (int k = 0; k < desc->n_load && status == FB_OK; k++) {
    /* Unit load f at the coordinate, less the inertia forces M R R^T f (R orthonormal) */
    const int at = fbi_coordinate_dof(&desc->load[k]);
    fb_real x[FBI_MAX_DOF] = {FB_R(0.0)}, row[FBI_MAX_DOF];
    x[at] = FB_R(1.0);
    for (int r = 0; r < n_free; r++) {
      const fb_real *shape = work->free + r * out->ndof;
      for (int i = 0; i < out->ndof; i++) {
        fbi_row_get(row, &rows, work->M, i);
        x[i] -= shape[at] * fbi_dot(row, shape, out->ndof);
      }
    }

    /* Deflection without rigid-body motion */
    fbi_static_solve(x, work, dof, n, out->ndof);
    fbi_orthogonalize(x, work->free, work->M, n_free, &rows);

    /* Taken unless the modes span it */
    if (out->n == FB_MAX_MODES) {
      status = FBI_REFUSE(FB_ERR_CAPACITY, FBI_WORD_ROOM, -1, FB_R(1.0) + (fb_real)out->n, FB_R(1.0) * FB_MAX_MODES);
    } else {
      (void)fbi_shape_take(work, beam, x, FB_R(0.0));
    }
  }
  return status;
}

/* Are there as many modes as the desc asks for? */
static fb_status fbi_count_check(const fb_modes_desc *desc, const int taken[FB_KIND_COUNT], int n)
{
  if (desc->lowest > 0) {
    return n < desc->lowest && !(desc->omega_limit > FB_R(0.0))
               ? FBI_REFUSE(FB_ERR_MODES, "lowest: count of modes that there are, at least", -1, (fb_real)n,
                            (fb_real)desc->lowest)
               : FB_OK;
  }
  for (int k = 0; k < FB_KIND_COUNT; k++) {
    if (desc->count[k] < FB_ALL_MODES && !(desc->omega_limit > FB_R(0.0)) && !(desc->mass_fraction > FB_R(0.0)) &&
        taken[k] < desc->count[k]) {
      return FBI_REFUSE(taken[k] > 0 ? FB_ERR_MODES : FB_ERR_KIND, "kind: count of its modes that there are, at least",
                        k, (fb_real)taken[k], (fb_real)desc->count[k]);
    }
  }
  return FB_OK;
}

/* Natural modes. With a spin the first half of the bending modes is taken at rest, the others under centrifugal
   tension. */
static fb_status fbi_natural_modes(const fb_modes_desc *desc, fb_modes_work *work, const fb_beam *beam,
                                   const int group[FB_KIND_COUNT])
{
  const fbi_rows rows = fbi_beam_rows(beam);
  fb_modes *out = &work->found;
  const int spinning = FB_FABS(desc->spin) > FB_R(0.0);
  const int n_free = fbi_free_fill(work, beam);
  int taken[FB_KIND_COUNT] = {0}, count[FB_KIND_COUNT];
  fb_status status;

  /* Modes at rest, then those at the spin */
  for (int k = 0; k < FB_KIND_COUNT; k++) {
    const int bending = k == FB_KIND_BEND_Y || k == FB_KIND_BEND_Z;
    count[k] = spinning && bending ? (desc->count[k] + 1) / 2 : desc->count[k];
  }
  status = fbi_modes_take(desc, work, beam, group, taken, count);
  if (status == FB_OK && spinning) {
    const fb_preload under = {FB_R(0.0), FB_R(0.0), desc->spin, desc->spin_radius};
    fbi_matrices(work->K, work->M, &rows, beam, &under);
    status = fbi_modes_take(desc, work, beam, group, taken, desc->count);
    fbi_matrices(work->K, work->M, &rows, beam, &desc->preload);
  }

  /* Attachment modes; Ritz modes of all of them */
  status = status ? status : fbi_count_check(desc, taken, out->n);
  status = status || desc->n_load == 0 ? status : fbi_static_take(desc, work, beam, group, n_free);
  status = status || (!spinning && desc->n_load == 0) ? status : fbi_modes_ritz(work, beam);
  if (status != FB_OK) {
    return status;
  }

  /* Ascending, rigid-body modes first */
  fbi_modes_sort(out);
  status = desc->rigid ? fbi_free_take(work, beam, n_free) : FB_OK;
  if (status != FB_OK) {
    return status;
  }

  /* M = 1, K = omega^2 */
  fbi_zero(out->M, out->n * out->n);
  fbi_zero(out->K, out->n * out->n);
  for (int k = 0; k < out->n; k++) {
    out->M[k * out->n + k] = FB_R(1.0);
    out->K[k * out->n + k] = out->omega[k] * out->omega[k];
  }
  return FB_OK;
}

/* Modal M and K of the shapes found. */
static void fbi_shapes_matrices(fb_modes_work *work, const fb_beam *beam)
{
  const fbi_rows rows = fbi_beam_rows(beam);
  fb_modes *out = &work->found;
  for (int a = 0; a < out->n; a++) {
    for (int b = 0; b < out->n; b++) {
      const fb_real *x = out->shape + a * out->ndof, *y = out->shape + b * out->ndof;
      out->M[a * out->n + b] = fbi_modal_product(x, work->M, y, &rows);
      out->K[a * out->n + b] = fbi_modal_product(x, work->K, y, &rows);
    }
  }
}

/* Zeroes rows of K for those of the first m shapes whose stiffness is below zero by round-off: they move as rigid
   bodies. A body refuses a stiffness below zero as buckled. */
static void fbi_rigid_clear(fb_modes_work *work, const fb_beam *beam, int m)
{
  const fbi_rows rows = fbi_beam_rows(beam);
  fb_modes *out = &work->found;
  for (int k = 0; k < m; k++) {
    const fb_real *x = out->shape + k * out->ndof, own = out->K[k * (out->n + 1)];
    fb_real size = FB_R(0.0); /* sum of the magnitudes of its terms */
    for (int i = 0; i < out->ndof; i++) {
      fb_real row[FBI_MAX_DOF];
      fbi_row_get(row, &rows, work->K, i);
      for (int j = 0; j < out->ndof; j++) {
        size += FB_FABS(x[i] * row[j] * x[j]);
      }
    }
    for (int a = 0; a < out->n && own < FB_R(0.0) && -own <= FBI_ROUNDING * size; a++) {
      out->K[k * out->n + a] = out->K[a * out->n + k] = FB_R(0.0);
    }
  }
}

/* Constraint modes of the boundary, x = 1 at one of its coordinates and 0 at the others, K x = 0 elsewhere; work.A
   holds the factor of K over the n coordinates dof. */
static void fbi_constraint_modes(fb_real *shape, const fb_modes_desc *desc, const fb_modes_work *work,
                                 const fb_beam *beam, const int *dof, int n)
{
  const fbi_rows rows = fbi_beam_rows(beam);
  for (int k = 0; k < desc->n_boundary; k++) {
    const int at = fbi_coordinate_dof(&desc->boundary[k]);
    fb_real *const x = shape + k * rows.ndof;
    for (int i = 0; i < rows.ndof; i++) {
      fb_real row[FBI_MAX_DOF];
      fbi_row_get(row, &rows, work->K, i);
      x[i] = -row[at];
    }
    fbi_static_solve(x, work, dof, n, rows.ndof);
    x[at] = FB_R(1.0);
  }
}

/* Boundary-acceleration modes K^-1 M x of the constraint modes x, added to the modes found. */
static void fbi_acceleration_modes(const fb_real *constraint, const fb_modes_desc *desc, fb_modes_work *work,
                                   const fb_beam *beam, const int *dof, int n)
{
  const fbi_rows rows = fbi_beam_rows(beam);
  for (int k = 0; k < desc->n_boundary; k++) {
    fb_real x[FBI_MAX_DOF];
    for (int i = 0; i < rows.ndof; i++) {
      fb_real row[FBI_MAX_DOF];
      fbi_row_get(row, &rows, work->M, i);
      x[i] = fbi_dot(row, constraint + k * rows.ndof, rows.ndof);
    }
    fbi_static_solve(x, work, dof, n, rows.ndof);
    (void)fbi_shape_take(work, beam, x, FB_R(0.0));
  }
}

/* Puts the m constraint modes, at the end of the table of shapes, in front of the modes found. */
static void fbi_constraint_take(const fb_modes_desc *desc, fb_modes_work *work, const fb_beam *beam, int m)
{
  fb_modes *out = &work->found;
  fbi_copy(work->X, out->shape + (FB_MAX_MODES - m) * out->ndof, m * out->ndof);
  for (int k = out->n - 1; k >= 0; k--) {
    fbi_shape_move(out, k + m, k);
  }
  out->n += m;
  for (int k = 0; k < m; k++) {
    fbi_copy(out->shape + k * out->ndof, work->X + k * out->ndof, out->ndof);
    out->kind[k] = fbi_dof_kind(beam, fbi_coordinate_dof(&desc->boundary[k]));
    out->omega[k] = FB_R(0.0);
  }
}

/* [E7.9] Hurty (Craig-Bampton) component: constraint modes, x_i = 1 at one boundary coordinate, 0 at the others, and K
   x = 0 elsewhere; then fixed-interface natural modes. K has no terms between the two kinds. boundary_inertia adds the
   boundary-acceleration modes K^-1 M x: with k modes of a cantilever held at its tip the k-th frequency is off by
   1.6e-3 without them, by 2e-7 with them.
   Source: [H] 2.5, C.3 with ERRATA.md H15.  Shapes: n_boundary constraint modes first.
   Fails: capacity; the boundary leaves rigid motion.
   Test: hurty_example_has_the_printed_numbers, components_deflect_exactly_at_their_boundary. */
static fb_status fbi_component_take(const fb_modes_desc *desc, fb_modes_work *work, const fb_beam *beam,
                                    const int group[FB_KIND_COUNT])
{
  fb_modes *out = &work->found;
  const int m = desc->n_boundary;
  fb_real *constraint;
  int taken[FB_KIND_COUNT] = {0}, dof[FBI_MAX_DOF], n;

  /* Fixed-interface modes */
  fb_status status = fbi_modes_take(desc, work, beam, group, taken, desc->count);
  status = status ? status : fbi_count_check(desc, taken, out->n);
  if (status != FB_OK) {
    return status;
  }

  /* Constraint modes, for now at the end of the table */
  if (out->n > FB_MAX_MODES - (desc->boundary_inertia ? 2 : 1) * m) {
    return FBI_REFUSE(FB_ERR_CAPACITY, FBI_WORD_ROOM, -1, (fb_real)(out->n + (desc->boundary_inertia ? 2 : 1) * m),
                      FB_R(1.0) * FB_MAX_MODES);
  }
  constraint = out->shape + (FB_MAX_MODES - m) * out->ndof;
  n = fbi_static_factor(&status, dof, work, beam, group);
  if (status != FB_OK) {
    return status;
  }
  fbi_constraint_modes(constraint, desc, work, beam, dof, n);

  /* Boundary-acceleration modes; Ritz modes of them and the fixed-interface ones */
  if (desc->boundary_inertia) {
    fbi_acceleration_modes(constraint, desc, work, beam, dof, n);
    status = fbi_modes_ritz(work, beam);
    if (status != FB_OK) {
      return status;
    }
  }

  /* Constraint modes in front of the others; M and K */
  fbi_modes_sort(out);
  fbi_constraint_take(desc, work, beam, m);
  fbi_shapes_matrices(work, beam);
  fbi_rigid_clear(work, beam, m);
  return FB_OK;
}

/* Displacement field of a mode (one coordinate) at s of an element, element axes. */
static void fbi_mode_field(fbi_field *f, const fb_beam *beam, const fb_modes *modes, int mode, int element, fb_real s)
{
  const fb_real *shape = modes->shape + mode * modes->ndof;
  fbi_functions local;
  fb_real value = FB_R(0.0), slope = FB_R(0.0), curvature = FB_R(0.0);

  /* Shape in finite-element coordinates */
  if (modes->degree == 0) {
    fb_real v[FBI_LOCAL] = {FB_R(0.0)};
    for (int i = 0; i < (beam->has_shear ? FBI_LOCAL : 20); i++) {
      v[i] = shape[fbi_element_dof(beam, element, i)];
    }
    fbi_element_field(f, beam, element, v, s);
    f->strain_slope = FB_R(0.0); /* used by E8.24 alone, which does not cover such modes */
    return;
  }

  /* Scalar element functions: value, slope, curvature */
  fbi_functions_eval(&local, s, fbi_element_length(beam, element), modes->degree);
  for (int k = 0; k <= modes->degree; k++) {
    const fb_real c = shape[fbi_function_dof(beam->desc.n_element, modes->degree, element, k)];
    value += c * local.value[k];
    slope += c * local.slope[k];
    curvature += c * local.curvature[k];
  }

  /* Displacement of the mode's kind */
  memset(f, 0, sizeof *f);
  if (modes->kind[mode] == FB_KIND_AXIAL) {
    f->u[0] = value;
    f->strain = slope;
    f->strain_slope = curvature;
  } else {
    const int y = modes->kind[mode] == FB_KIND_BEND_Y;
    f->u[y ? 1 : 2] = value;
    f->theta[y ? 2 : 1] = y ? slope : -slope;
    f->slope[y ? 0 : 1] = slope;
    f->curvature[y ? 2 : 1] = y ? curvature : -curvature;
  }
}

/* Modal M and K from the fields of the modes, by quadrature. */
static void fbi_modes_matrices(fb_modes *modes, const fb_beam *beam)
{
  const int n = modes->n, last = beam->desc.n_element - 1;
  fbi_cell cell = {0, FB_R(0.0), FB_R(0.0)};
  fbi_field f[FB_MAX_MODES];
  fbi_section_field at[FB_MAX_MODES];
  fbi_zero(modes->M, n * n);
  fbi_zero(modes->K, n * n);

  /* Beam */
  while (fbi_cell_next(&cell, beam)) {
    for (int g = 0; g < FBI_GAUSS; g++) {
      fb_section section;
      fb_beam_section_eval(beam, &section, cell.x0 + fbi_gauss_x[g] * (cell.x1 - cell.x0));
      for (int a = 0; a < n; a++) {
        fbi_mode_field(&f[a], beam, modes, a, cell.element, fbi_cell_s(&cell, beam, fbi_gauss_x[g]));
        fbi_section_eval(&at[a], &f[a], &section);
      }
      for (int ab = 0; ab < n * n; ab++) {
        fb_real k, m;
        fbi_field_products(&k, &m, &at[ab / n], &at[ab % n], &section, FB_R(0.0));
        modes->K[ab] += fbi_gauss_w[g] * (cell.x1 - cell.x0) * k;
        modes->M[ab] += fbi_gauss_w[g] * (cell.x1 - cell.x0) * m;
      }
    }
  }

  /* Lumped bodies (E6.4) */
  for (int i = 0; i < beam->desc.n_lump; i++) {
    const fb_lump *lump = &beam->desc.lump[i];
    const fb_real *J = lump->inertia;
    const int element = lump->node < last ? lump->node : last;
    for (int a = 0; a < n; a++) {
      fbi_mode_field(&f[a], beam, modes, a, element, (fb_real)(lump->node - element));
      fbi_vec3_add_cross(f[a].u, f[a].theta, lump->center);
    }
    for (int ab = 0; ab < n * n; ab++) {
      const fb_real *const a = f[ab / n].theta, *const b = f[ab % n].theta; /* theta_x = 0: no torsion */
      const fb_real turn = a[1] * (J[1] * b[1] + J[5] * b[2]) + a[2] * (J[5] * b[1] + J[2] * b[2]);
      modes->M[ab] += lump->mass * fb_vec3_dot(f[ab / n].u, f[ab % n].u) + turn;
    }
  }
}

/* Directions of the basis of functions, in the order of its coordinates, and its matrices. */
static const fb_kind fbi_function_kind[3] = {FB_KIND_BEND_Y, FB_KIND_BEND_Z, FB_KIND_AXIAL};
static fbi_rows fbi_function_rows(const fb_beam *beam, int degree)
{
  return fbi_rows_of(beam->desc.n_element, 2, degree - 3, 0);
}

/* Mass and bending stiffness (axial stiffness, where there is no bending) of the scalar element functions, to work.M
   and work.K. */
static void fbi_functions_matrices(fb_modes_work *work, const fb_beam *beam, const int group[FB_KIND_COUNT], int degree)
{
  const int ne = beam->desc.n_element;
  const fbi_rows rows = fbi_function_rows(beam, degree);
  const fb_real l = fbi_element_length(beam, 0);
  fbi_cell cell = {0, FB_R(0.0), FB_R(0.0)};
  fbi_zero(work->K, rows.ndof * rows.width);
  fbi_zero(work->M, rows.ndof * rows.width);
  while (fbi_cell_next(&cell, beam)) {
    for (int g = 0; g < FBI_GAUSS; g++) {
      const fb_real dx = fbi_gauss_w[g] * (cell.x1 - cell.x0);
      const int bends = group[FB_KIND_BEND_Y] >= 0 || group[FB_KIND_BEND_Z] >= 0;
      fbi_functions f;
      fb_section section;
      const fb_real *d = bends ? f.curvature : f.slope;
      fb_real stiffness;

      /* Bending stiffness, or axial stiffness */
      fb_beam_section_eval(beam, &section, cell.x0 + fbi_gauss_x[g] * (cell.x1 - cell.x0));
      stiffness = group[FB_KIND_BEND_Y] >= 0 ? section.EI_z : bends ? section.EI_y : section.EA;

      /* Added to the assembled matrices */
      fbi_functions_eval(&f, fbi_cell_s(&cell, beam, fbi_gauss_x[g]), l, degree);
      for (int i = 0; i <= degree; i++) {
        for (int j = 0; j <= degree; j++) {
          const int at = fbi_row_place(&rows, fbi_function_dof(ne, degree, cell.element, i),
                                       fbi_function_dof(ne, degree, cell.element, j));
          work->K[at] += dx * stiffness * d[i] * d[j];
          work->M[at] += dx * section.mass * f.value[i] * f.value[j];
        }
      }
    }
  }

  /* Masses of lumped bodies */
  for (int i = 0; i < beam->desc.n_lump; i++) {
    const int at = 2 * beam->desc.lump[i].node;
    work->M[fbi_row_place(&rows, at, at)] += beam->desc.lump[i].mass;
  }
}

/* Refuses what this basis cannot do. Counts of functions along y, z and x: FB_ALL_MODES takes all of a direction that
   exists. */
static fb_status fbi_functions_check(int count[3], const fb_modes_desc *desc, const fb_beam *beam,
                                     const int group[FB_KIND_COUNT], int degree)
{
  const int m = fbi_function_ndof(beam->desc.n_element, degree) - 2;
  if (beam->desc.root != FB_ROOT_CLAMPED || beam->desc.n_point > 0 || desc->degree < 0 || degree < 3 ||
      degree > FBI_DEGREE) {
    return FB_ERR_VALUE;
  }
  if (beam->has_shear || desc->count[FB_KIND_TORSION] > 0 || (desc->root_strain && desc->count[FB_KIND_AXIAL] == 0)) {
    return FB_ERR_UNSUPPORTED;
  }
  for (int d = 0; d < 3; d++) {
    const fb_kind kind = fbi_function_kind[d];
    count[d] = desc->count[kind] < FB_ALL_MODES ? desc->count[kind] : group[kind] >= 0 ? m : 0;
    if (count[d] > m) {
      return FB_ERR_MODES;
    }
  }
  return count[0] + count[1] + count[2] + (desc->root_strain != 0) > FB_MAX_MODES ? FB_ERR_CAPACITY : FB_OK;
}

/* Clamped bending modes of the scalar element functions, K x = omega^2 M x without the first two of those, value and
   slope at the root. Returns them, mass-normalized and positive at the tip, as full-length rows of work.A. */
static fb_status fbi_functions_solve(fb_modes_work *work, const fb_beam *beam, const int group[FB_KIND_COUNT],
                                     int degree)
{
  const fbi_rows rows = fbi_function_rows(beam, degree);
  const int m = rows.ndof - 2, tip = 2 * beam->desc.n_element - 2;
  int dof[FBI_MAX_DOF] = {0};
  fb_status status;
  fbi_functions_matrices(work, beam, group, degree);
  for (int i = 0; i < m; i++) {
    dof[i] = i + 2;
  }
  fbi_rows_pick(work->X, work->K, &rows, dof, m);
  fbi_rows_pick(work->A, work->M, &rows, dof, m);
  status = fbi_eig_gen_solve(work->omega2, work->X, work->A, m);
  for (int k = 0; k < m && status == FB_OK; k++) {
    const fb_real *const x = work->X + k * m, sign = x[tip] < FB_R(0.0) ? -FB_R(1.0) : FB_R(1.0);
    fb_real *const f = work->A + k * rows.ndof;
    f[0] = f[1] = FB_R(0.0);
    for (int i = 0; i < m; i++) {
      f[2 + i] = sign * x[i];
    }
  }
  return status;
}

/* [E7.5] One set of functions of x for u_x, u_y and u_z: the bending modes of the smooth element functions, orthonormal
   with respect to the mass. Then ups_ab of two different functions vanishes, and S(q) is constant for equal counts.
   Source: [DB] 4.3 (the same basis functions in each direction), orthonormalized.  Shapes: m functions of ndof.
   Fails: no mass, not clamped, more modes asked for than there are.
   Test: functions_are_orthonormal_and_as_smooth_as_they_claim, functions_close_the_basis. */
static fb_status fbi_functions_take(const fb_modes_desc *desc, fb_modes_work *work, const fb_beam *beam,
                                    const int group[FB_KIND_COUNT])
{
  const int degree = desc->degree > 0 ? desc->degree : 3;
  const fbi_rows rows = fbi_function_rows(beam, degree);
  const int ndof = rows.ndof, m = ndof - 2;
  fb_modes *out = &work->found;
  int count[3];
  fb_status status = fbi_functions_check(count, desc, beam, group, degree);
  status = status ? status : fbi_functions_solve(work, beam, group, degree);
  if (status != FB_OK) {
    return status;
  }

  /* y, z and x alternate, so that successive terms of sums over coordinates are independent */
  out->degree = degree;
  out->ndof = ndof;
  for (int k = 0; k < m; k++) {
    for (int d = 0; d < 3; d++) {
      if (k < count[d]) {
        out->kind[out->n] = fbi_function_kind[d];
        fbi_copy(out->shape + out->n++ * ndof, work->A + k * ndof, ndof);
      }
    }
  }

  /* Axial function with a strain at the root, orthogonal to the others */
  if (desc->root_strain && count[2] > 0) {
    fb_real *shape = out->shape + out->n * ndof;
    fbi_zero(shape, ndof);
    shape[1] = FB_R(1.0);
    fbi_orthonormalize(shape, work->A, work->M, m, &rows);
    out->kind[out->n++] = FB_KIND_AXIAL;
  }

  /* M and K */
  fbi_zero(out->omega, out->n);
  fbi_modes_matrices(out, beam);
  return FB_OK;
}

#if FB_WITH_DETAIL
/* What a beam lacks to have modes of kind k. */
static const char *fbi_kind_word(const fb_beam *beam, int k)
{
  static const char *const soft[FB_KIND_COUNT] = {
      "kind: bending modes along y asked for, EI_z [N m^2] of some station, above",
      "kind: bending modes along z asked for, EI_y [N m^2] of some station, above",
      "kind: axial modes asked for, EA [N] of some station, above",
      "kind: torsion modes asked for, GJ [N m^2] of some station, above"};
  static const char *const heavy[FB_KIND_COUNT] = {
      "kind: bending modes along y asked for, mass [kg/m] of some station, above",
      "kind: bending modes along z asked for, mass [kg/m] of some station, above",
      "kind: axial modes asked for, mass [kg/m] of some station, above",
      "kind: torsion modes asked for, i_y or i_z [kg m] of some station, above"};
  fb_real most = FB_R(0.0);
  for (int i = 0; i < beam->desc.n_station; i++) {
    const fb_section *s = &beam->desc.station[i];
    const fb_real stiffness[FB_KIND_COUNT] = {s->EI_z, s->EI_y, s->EA, s->GJ};
    most = fbi_larger(most, stiffness[k]);
  }
  return most > FB_R(0.0) ? heavy[k] : soft[k];
}
#endif

/* Checks a list of nodal coordinates: existing, not constrained, of an existing kind, each named once. */
static fb_status fbi_coordinates_check(const fb_coordinate *list, int n, const fb_beam *beam,
                                       const int group[FB_KIND_COUNT])
{
  if (n < 0 || n > FB_MAX_COORDINATES) {
    return FBI_REFUSE(n < 0 ? FB_ERR_VALUE : FB_ERR_CAPACITY, "n_load or n_boundary, 0 to FB_MAX_COORDINATES, beyond",
                      -1, (fb_real)n, n < 0 ? FB_R(0.0) : FB_R(1.0) * FB_MAX_COORDINATES);
  }
  for (int k = 0; k < n; k++) {
    const fbi_count there[] = {FBI_COUNT(list[k].node, 0, beam->desc.n_element, "coordinate: node, beyond"),
                               FBI_COUNT(list[k].axis, 0, 5, "coordinate: axis, beyond")};
    const fb_status status = fbi_counts_check(FB_ERR_CAPACITY, there, FBI_LENGTH(there), k);
    if (status != FB_OK) {
      return status;
    }
    if (fbi_is_held(beam, fbi_coordinate_dof(&list[k]))) {
      return FBI_REFUSE(FB_ERR_VALUE, "coordinate: held by the root", k, FB_R(0.0), FB_R(0.0));
    }
    if (group[fbi_dof_kind(beam, fbi_coordinate_dof(&list[k]))] < 0) {
      return FBI_REFUSE(FB_ERR_KIND, "coordinate: of a kind without stiffness or inertia", k, FB_R(0.0), FB_R(0.0));
    }
    for (int j = 0; j < k; j++) {
      if (fbi_coordinate_dof(&list[j]) == fbi_coordinate_dof(&list[k])) {
        return FBI_REFUSE(FB_ERR_VALUE, "coordinate: named twice", k, FB_R(0.0), FB_R(0.0));
      }
    }
  }
  return FB_OK;
}

static fb_status fbi_modes_desc_check(const fb_modes_desc *desc, const fb_beam *beam, int hold_boundary)
{
  const fb_preload *load = &desc->preload;
  const fb_real all[8] = {desc->omega_limit, desc->spin,         desc->spin_radius, desc->mass_fraction,
                          load->force,       load->acceleration, load->spin,        load->spin_radius};
  const int spinning = FB_FABS(desc->spin) > FB_R(0.0), by_mass = desc->mass_fraction > FB_R(0.0);
  const int loaded = fbi_is_loaded(load), modes = desc->basis == FB_BASIS_MODES;
  const int clamped = beam->desc.root == FB_ROOT_CLAMPED;

  /* Finite values in range */
  const fbi_number field[] = {FBI_NOT_NEGATIVE(&desc->omega_limit, 1, "omega_limit [rad/s]"),
                              FBI_NUMBER(&desc->mass_fraction, 1, FB_R(0.0), FB_R(1.0), "mass_fraction, beyond"),
                              FBI_ANY(&desc->spin, 1, "spin [rad/s]"),
                              FBI_ANY(&desc->spin_radius, 1, "spin_radius [m]"),
                              FBI_ANY(&load->force, 1, "preload.force [N]"),
                              FBI_ANY(&load->acceleration, 1, "preload.acceleration [m/s^2]"),
                              FBI_ANY(&load->spin, 1, "preload.spin [rad/s]"),
                              FBI_ANY(&load->spin_radius, 1, "preload.spin_radius [m]")};
  const fbi_count count[] = {FBI_AT_LEAST(desc->count[FB_KIND_BEND_Y], 0, "count of bending modes along y"),
                             FBI_AT_LEAST(desc->count[FB_KIND_BEND_Z], 0, "count of bending modes along z"),
                             FBI_AT_LEAST(desc->count[FB_KIND_AXIAL], 0, "count of axial modes"),
                             FBI_AT_LEAST(desc->count[FB_KIND_TORSION], 0, "count of torsion modes"),
                             FBI_AT_LEAST(desc->lowest, 0, "lowest"),
                             FBI_COUNT((int)desc->basis, 0, (int)FB_BASIS_COUNT - 1, "basis, an fb_basis, beyond")};

  /* Options that need a clamped root (a preload acts on rigid-body motion, too) or natural modes, or that exclude each
     other */
  const fbi_claim claim[] = {
      FBI_CLAIM(!(spinning || by_mass) || clamped, "spin or mass_fraction, with FB_ROOT_CLAMPED only"),
      FBI_CLAIM(!(spinning || by_mass) || modes, "spin or mass_fraction, with FB_BASIS_MODES only"),
      FBI_CLAIM(!loaded || !modes || clamped || hold_boundary, "preload of natural modes, with FB_ROOT_CLAMPED only"),
      FBI_CLAIM(!spinning || desc->lowest <= 0, "spin, not with lowest"),
      FBI_CLAIM(!(spinning || loaded) || beam->desc.n_point <= 0, "spin or preload, not of a beam by points"),
      FBI_CLAIM(!spinning || !loaded, "spin, not with preload"),
      FBI_CLAIM(!loaded || desc->basis != FB_BASIS_FUNCTIONS, "preload, not with FB_BASIS_FUNCTIONS"),
      FBI_CLAIM(!by_mass || desc->lowest <= 0, "mass_fraction, not with lowest")};
  fb_status status = fbi_numbers_check(field, FBI_LENGTH(field), -1);
  status = fbi_is_finite(all, 8) ? status : FB_ERR_NOT_FINITE;
  status = status ? status : fbi_counts_check(FB_ERR_VALUE, count, FBI_LENGTH(count), -1);
  return status ? status : fbi_claims_check(claim, FBI_LENGTH(claim), -1);
}

/* Matrices, groups, rigid motions and constrained coordinates: the common beginning of all bases and of buckling. */
static fb_status fbi_modes_prepare(int group[FB_KIND_COUNT], fb_modes_work *work, const fb_beam *beam,
                                   const fb_modes_desc *desc, int hold_boundary)
{
  const fbi_rows rows = fbi_beam_rows(beam);
  fb_modes *out = &work->found;
  fb_status status = fbi_modes_desc_check(desc, beam, hold_boundary);
  if (status != FB_OK) {
    return status;
  }

  /* Matrices under the preload, kinds and coordinates that they have */
  out->n = 0;
  out->degree = out->joined = 0;
  out->ndof = rows.ndof;
  fbi_matrices(work->K, work->M, &rows, beam, &desc->preload);
  fbi_kind_groups(group, beam, work->K, work->M);
  for (int k = 0; k < FB_KIND_COUNT; k++) {
    if (desc->count[k] > 0 && desc->count[k] < FB_ALL_MODES && group[k] < 0) {
      return FBI_REFUSE(FB_ERR_KIND, fbi_kind_word(beam, k), k, FB_R(0.0), FB_R(0.0));
    }
  }
  status = fbi_coordinates_check(desc->load, desc->n_load, beam, group);
  status = status ? status : fbi_coordinates_check(desc->boundary, desc->n_boundary, beam, group);
  if (status != FB_OK) {
    return status;
  }

  /* Constrained: root condition, internal coordinates of cubic elements, boundary */
  for (int i = 0; i < out->ndof; i++) {
    const int internal = i - 6 * (beam->desc.n_element + 1); /* shear coordinates come after these */
    work->held[i] = fbi_is_held(beam, i) || (desc->cubic && internal >= 0 && internal < 8 * beam->desc.n_element);
  }
  for (int k = 0; k < desc->n_boundary && hold_boundary; k++) {
    work->held[fbi_coordinate_dof(&desc->boundary[k])] = 1;
  }

  /* Rigid motions and their inertia */
  fbi_rigid_fill(work->rigid, beam);
  for (int i = 0; i < 6; i++) {
    const fb_real *r = work->rigid + i * out->ndof;
    out->rigid_mass[i] = fbi_modal_product(r, work->M, r, &rows);
    out->effective[i] = FB_R(0.0);
  }
  return FB_OK;
}

/* Momenta x^T M r of the coordinates x under each rigid motion r of the root, and the fraction of the beam's inertia
   that they carry: L^T M^-1 L / (r^T M r), L the momenta (E7.7). */
static void fbi_effective_fill(fb_modes_work *work, const fb_beam *beam)
{
  const fbi_rows rows = fbi_beam_rows(beam);
  fb_modes *out = &work->found;
  const int n = out->n;
  for (int k = 0; k < 6 * n; k++) {
    out->momentum[k] =
        fbi_modal_product(out->shape + k / 6 * out->ndof, work->M, work->rigid + k % 6 * out->ndof, &rows);
  }
  fbi_copy(work->A, out->M, n * n);
  if (fb_chol_factor(work->A, n) != FB_OK) { /* coordinates without inertia */
    return;
  }
  for (int i = 0; i < 6; i++) {
    fb_real momentum[FB_MAX_MODES] = {FB_R(0.0)}, x[FB_MAX_MODES] = {FB_R(0.0)};
    for (int a = 0; a < n; a++) {
      momentum[a] = out->momentum[6 * a + i];
    }
    fb_chol_solve(x, work->A, momentum, n);
    out->effective[i] = out->rigid_mass[i] > FB_R(0.0) ? fbi_dot(x, momentum, n) / out->rigid_mass[i] : FB_R(0.0);
  }
}

FB_DEF fb_status fb_modes_solve(fb_modes *modes, fb_modes_work *work, const fb_beam *beam, const fb_modes_desc *desc)
{
  int group[FB_KIND_COUNT];
  fb_status status;
  FBI_REQUIRE(modes && work && beam && desc, FB_ERR_NULL);
  status = fbi_modes_prepare(group, work, beam, desc, desc->basis == FB_BASIS_COMPONENT);
  if (status != FB_OK) {
    return status;
  }

  /* The basis */
  switch (desc->basis) {
  case FB_BASIS_ELEMENTS:
    status = fbi_elements_take(desc, work, beam, group);
    break;
  case FB_BASIS_FUNCTIONS:
    status = fbi_functions_take(desc, work, beam, group);
    break;
  case FB_BASIS_COMPONENT:
    status = fbi_component_take(desc, work, beam, group);
    break;
  default:
    status = fbi_natural_modes(desc, work, beam, group);
  }
  if (status != FB_OK) {
    return status;
  }

  /* Effective masses */
  if (desc->basis != FB_BASIS_FUNCTIONS) {
    fbi_effective_fill(work, beam);
  }
  *modes = work->found;
  return FB_OK;
}

/* [E7.10] Buckling, (K + factor K_G) x = 0 as the largest eigenvalues of -K_G x = (1/factor) K x, K_G the geometric
   stiffness of the preload.
   Source: [H] C.1-26.  Shapes: rows of ndof.  Fails: rigid motion; no positive factor.
   Test: columns_buckle_under_the_published_loads. */
FB_DEF fb_status fb_buckling_solve(fb_modes *modes, fb_modes_work *work, const fb_beam *beam, const fb_modes_desc *desc)
{
  const fb_preload none = {FB_R(0.0), FB_R(0.0), FB_R(0.0), FB_R(0.0)};
  int group[FB_KIND_COUNT], dof[FBI_MAX_DOF] = {0}, n, wanted;
  fbi_rows rows;
  fb_modes *out;
  fb_status status;
  FBI_REQUIRE(modes && work && beam && desc, FB_ERR_NULL);
  rows = fbi_beam_rows(beam);
  out = &work->found;
  status = fbi_modes_prepare(group, work, beam, desc, 1);
  if (status != FB_OK) {
    return status;
  }

  /* Number of factors; a preload must be there */
  wanted = desc->lowest > 0 ? desc->lowest : 1;
  if (!fbi_is_loaded(&desc->preload) || wanted > FB_MAX_MODES) {
    return wanted > FB_MAX_MODES ? FBI_REFUSE(FB_ERR_CAPACITY, "lowest, FB_MAX_MODES, at most", -1, (fb_real)wanted,
                                              FB_R(1.0) * FB_MAX_MODES)
                                 : FBI_REFUSE(FB_ERR_VALUE, "preload, not all 0", -1, FB_R(0.0), FB_R(0.0));
  }

  /* -K_G x = (1/factor) K x; K + K_G is that of the preload, K alone must be definite */
  n = fbi_elastic_dofs(dof, work, beam, group);
  fbi_rows_pick(work->X, work->K, &rows, dof, n);
  fbi_matrices(work->K, work->M, &rows, beam, &none);
  fbi_rows_pick(work->A, work->K, &rows, dof, n);
  for (int i = 0; i < n * n; i++) {
    work->X[i] = work->A[i] - work->X[i];
  }
  status = fbi_eig_gen_solve(work->omega2, work->X, work->A, n);

  /* Positive factors from the smallest on */
  for (int k = n - 1; k >= 0 && out->n < wanted && status == FB_OK; k--) {
    fb_real *shape = out->shape + out->n * out->ndof;
    if (!(work->omega2[k] > (fb_real)n * FB_EPSILON * fbi_larger(work->omega2[n - 1], -work->omega2[0]))) {
      break;
    }
    fbi_group_shape(shape, work, dof, k, n, out->ndof);
    out->kind[out->n] = fbi_shape_kind(beam, shape, work->M);
    out->omega[out->n] = FB_R(1.0) / work->omega2[k];
    fbi_shape_scale(out, out->n, fbi_modal_product(shape, work->M, shape, &rows), beam->desc.n_element);
    out->n++;
  }
  if (status != FB_OK || out->n < wanted) {
    return status != FB_OK ? status
                           : FBI_REFUSE(FB_ERR_MODES, "lowest: count of positive factors that there are, at least", -1,
                                        (fb_real)out->n, (fb_real)wanted);
  }

  /* M and K of the shapes */
  fbi_shapes_matrices(work, beam);
  fbi_effective_fill(work, beam);
  *modes = work->found;
  return FB_OK;
}

/* Displacement and rotation of an element node, body axes, by a unit of coordinate a of a component. */
static void fbi_weld_motion(fb_real motion[6], const fb_beam *beam, const fb_modes *modes, int a, int node)
{
  const fb_real *value = modes->shape + a * modes->ndof + 6 * node;
  fb_mat33_mul_vec3(motion, beam->axes, value);
  fb_mat33_mul_vec3(motion + 3, beam->axes, value + 3);
}

/* Position of an element node, body axes. */
static void fbi_weld_place(fb_real place[3], const fb_beam *beam, int node)
{
  fb_mat33_mul_vec3(place, beam->axes, beam->node + 3 * node);
  fbi_vec3_add(place, FB_R(1.0), beam->desc.position);
}

static fb_status fbi_join_check(const fb_beam *beam, const fb_modes *component, const fb_join_desc *desc,
                                int n_component)
{
  const fbi_number field[] = {FBI_NOT_NEGATIVE(&desc->omega_limit, 1, "omega_limit [rad/s]")};
  const fbi_count least[] = {FBI_AT_LEAST(desc->lowest, 0, "lowest"), FBI_AT_LEAST(n_component, 1, "n_component"),
                             FBI_AT_LEAST(desc->n_weld, 0, "n_weld")};
  const fbi_count most[] = {FBI_AT_MOST(n_component, FB_MAX_COMPONENTS, "n_component, FB_MAX_COMPONENTS"),
                            FBI_AT_MOST(desc->n_weld, FB_MAX_WELDS, "n_weld, FB_MAX_WELDS")};
  fb_status status = fbi_numbers_check(field, FBI_LENGTH(field), -1);
  status = status ? status : fbi_counts_check(FB_ERR_VALUE, least, FBI_LENGTH(least), -1);
  status = status ? status : fbi_counts_check(FB_ERR_CAPACITY, most, FBI_LENGTH(most), -1);

  /* Components: modes of these beams */
  for (int c = 0; c < n_component && status == FB_OK; c++) {
    const fbi_count count[] = {FBI_COUNT(component[c].n, 0, FB_MAX_MODES, "component: count of modes, beyond")};
    const fbi_claim claim[] = {
        FBI_CLAIM(component[c].degree <= 0, "component: modes of another basis than FB_BASIS_FUNCTIONS"),
        FBI_CLAIM(component[c].ndof == fbi_beam_ndof(&beam[c]), "component: modes of the beam of the same number")};
    status = fbi_counts_check(FB_ERR_CAPACITY, count, FBI_LENGTH(count), c);
    status = status ? status : fbi_claims_check(claim, FBI_LENGTH(claim), c);
  }

  /* Rigid connections: nodes of two components at the same place */
  for (int k = 0; k < desc->n_weld && status == FB_OK; k++) {
    const fb_weld *const weld = &desc->weld[k];
    fb_real place[2][3], size = FB_R(0.0);
    for (int side = 0; side < 2; side++) {
      const int c = weld->component[side];
      if (c < 0 || c >= n_component || weld->node[side] < 0 || weld->node[side] > beam[c].desc.n_element) {
        return FBI_REFUSE_AT(FB_ERR_CAPACITY, "weld: component and node, both existing; on its side, 0 or 1, node", k,
                             (fb_real)weld->node[side], FB_R(0.0), (fb_real)side);
      }
      fbi_weld_place(place[side], &beam[c], weld->node[side]);
      size = fbi_larger(size, beam[c].desc.length);
    }
    fbi_vec3_add(place[0], -FB_R(1.0), place[1]);
    if (weld->component[0] == weld->component[1]) {
      return FBI_REFUSE(FB_ERR_VALUE, "weld: two different components, not twice", k, (fb_real)weld->component[0],
                        FB_R(0.0));
    }
    if (fbi_vec3_norm(place[0]) > FB_R(1e-4) * size) {
      return FBI_REFUSE(FB_ERR_VALUE, "weld: distance [m] of its nodes, at most", k, fbi_vec3_norm(place[0]),
                        FB_R(1e-4) * size);
    }
  }
  return status;
}

/* Scales of a component's coordinates to modal mass 1, without mass to modal stiffness 1. */
static void fbi_join_scale(fb_real *scale, const fb_modes *component)
{
  const int n = component->n;
  for (int a = 0; a < n; a++) {
    const fb_real mass = component->M[a * n + a], stiffness = component->K[a * n + a];
    const fb_real unit = mass > FB_R(0.0) ? mass : stiffness;
    scale[a] = unit > FB_R(0.0) ? FB_R(1.0) / FB_SQRT(unit) : FB_R(1.0);
  }
}

/* Blocks of K and M of a component whose coordinates start at `at` of N. */
static void fbi_join_block(fb_join_work *work, const fb_modes *component, int at, int N)
{
  const int n = component->n;
  for (int ab = 0; ab < n * n; ab++) {
    const int i = at + ab / n, j = at + ab % n;
    work->K[i * N + j] = component->K[ab] * work->scale[i] * work->scale[j];
    work->M[i * N + j] = component->M[ab] * work->scale[i] * work->scale[j];
  }
}

/* rows (6 x n of N columns) += side times the motion of a node by each scaled coordinate of a component; rotations
   times the length. */
static void fbi_weld_add(fb_real *rows, const fb_beam *beam, const fb_modes *component, const fb_real *scale, int node,
                         fb_real side, fb_real length, int N)
{
  for (int a = 0; a < component->n; a++) {
    fb_real motion[6];
    fbi_weld_motion(motion, beam, component, a, node);
    for (int i = 0; i < 6; i++) {
      const fb_real unit = i < 3 ? side : side * length;
      rows[i * N + a] += unit * motion[i] * scale[a];
    }
  }
}

/* Block-diagonal K and M of the components and the constraints T q = 0 of the rigid connections (welds): motion of
   side 0 less that of side 1, T in work->X. Returns the number of coordinates. */
static int fbi_join_assemble(fb_join_work *work, const fb_beam *beam, const fb_modes *component,
                             const fb_join_desc *desc, int n_component)
{
  int N = 0, at = 0;
  for (int c = 0; c < n_component; c++) {
    N += component[c].n;
  }
  fbi_zero(work->K, N * N);
  fbi_zero(work->M, N * N);
  fbi_zero(work->X, 6 * desc->n_weld * N);

  /* Blocks and columns of each component */
  for (int c = 0; c < n_component; c++) {
    fbi_join_scale(work->scale + at, &component[c]);
    fbi_join_block(work, &component[c], at, N);
    for (int w = 0; w < 2 * desc->n_weld; w++) {
      const fb_weld *weld = &desc->weld[w / 2];
      if (weld->component[w % 2] == c) {
        fbi_weld_add(work->X + 6 * (w / 2) * N + at, &beam[c], &component[c], work->scale + at, weld->node[w % 2],
                     w % 2 ? -FB_R(1.0) : FB_R(1.0), beam[0].desc.length, N);
      }
    }
    at += component[c].n;
  }
  return N;
}

/* Complete pivoting: largest |T_rc| of the rows from `rank` on and the columns without a pivot; returns it. */
static fb_real fbi_null_pivot(int *row, int *column, const fb_real *T, const int *pivot, int rank, int rows, int N)
{
  fb_real largest = FB_R(0.0);
  for (int at = rank * N; at < rows * N; at++) {
    if (pivot[at % N] < 0 && FB_FABS(T[at]) > largest) {
      largest = FB_FABS(T[at]);
      *row = at / N;
      *column = at % N;
    }
  }
  return largest;
}

/* Row `row` is exchanged with row `rank`, scaled to 1 in `column` and subtracted from all others, whose elements
   in that column become 0. */
static void fbi_null_eliminate(fb_real *T, int row, int column, int rank, int rows, int N)
{
  fb_real *const own = T + rank * N, *const other = T + row * N;
  fb_real scale;
  for (int j = 0; j < N; j++) {
    const fb_real swap = other[j];
    other[j] = own[j];
    own[j] = swap;
  }
  scale = FB_R(1.0) / own[column];
  for (int j = 0; j < N; j++) {
    own[j] *= scale;
  }
  for (int i = 0; i < rows; i++) {
    if (i != rank) {
      fbi_row_sub(T + i * N, T[i * N + column], own, N);
    }
  }
}

/* Column of the null space for a column of T without a pivot: that coordinate is 1, those with a pivot follow from T,
   all others are 0. */
static void fbi_null_column(fb_real *Z, const fb_real *T, const int *pivot, int column, int N, int stride)
{
  for (int i = 0; i < N; i++) {
    Z[i * stride] = i == column ? FB_R(1.0) : FB_R(0.0);
    if (pivot[i] >= 0) {
      Z[i * stride] = -T[pivot[i] * N + column];
    }
  }
}

/* [E7.11] Null space of T (rows x N) by Gauss-Jordan elimination with complete pivoting: T [B N] = [1 0] up to the
   order of columns, so that Z = [-B; 1] spans it. Rows that depend on others are dropped. Z is N x (N - rank),
   the rank is returned. pivot: the row that a column was eliminated with, or -1.
   Source: [H] 3.6-10; [GV] 3.4.  Fails: never.  Test: joined_halves_are_the_whole. */
static int fbi_null_space(fb_real *Z, fb_real *T, int *pivot, int rows, int N)
{
  fb_real first = FB_R(0.0);
  int rank = 0, found = 0;
  for (int j = 0; j < N; j++) {
    pivot[j] = -1;
  }

  /* Elimination, until what is left is round-off of the first pivot */
  for (; rank < rows; rank++) {
    int row = rank, column = 0;
    const fb_real largest = fbi_null_pivot(&row, &column, T, pivot, rank, rows, N);
    first = rank == 0 ? largest : first;
    if (!(largest > FBI_ROUNDING * first)) {
      break;
    }
    fbi_null_eliminate(T, row, column, rank, rows, N);
    pivot[column] = rank;
  }

  /* One column of Z for each column without a pivot */
  for (int j = 0; j < N; j++) {
    if (pivot[j] < 0) {
      fbi_null_column(Z + found, T, pivot, j, N, N - rank);
      found++;
    }
  }
  return rank;
}

/* A = Z^T A Z: A is N x N before and m x m after. */
static void fbi_congruence(fb_real *A, const fb_real *Z, fb_real *scratch, int N, int m)
{
  for (int i = 0; i < N; i++) {
    for (int j = 0; j < m; j++) {
      fb_real sum = FB_R(0.0);
      for (int k = 0; k < N; k++) {
        sum += A[i * N + k] * Z[k * m + j];
      }
      scratch[i * m + j] = sum;
    }
  }
  for (int i = 0; i < m; i++) {
    for (int j = 0; j < m; j++) {
      A[i * m + j] = FB_R(0.0);
      for (int k = 0; k < N; k++) {
        A[i * m + j] += Z[k * m + i] * scratch[k * m + j];
      }
    }
  }
}

/* Is K (m x m) positive definite, with squared pivots well above the round-off of their diagonal elements? */
static int fbi_join_is_definite(fb_join_work *work, int m)
{
  int definite;
  fbi_copy(work->A, work->K, m * m);
  definite = fb_chol_factor(work->A, m) == FB_OK;
  for (int i = 0; i < m * (m + 1) && definite; i += m + 1) {
    definite = work->A[i] * work->A[i] > FB_R(16.0) * FBI_ROUNDING * work->K[i];
  }
  return definite;
}

/* Number of rigid-body modes, whose omega^2 is round-off of the largest, and omega^2 of the lowest elastic mode as the
   shift; both from K x = omega^2 M x. All modes are rigid where there is no stiffness: shift 0. */
static fb_status fbi_join_rigid(fb_join_work *work, int *rigid, fb_real *shift, int m)
{
  const fb_real noise = FB_R(8.0) * (fb_real)m * FB_EPSILON;
  fb_status status;
  fbi_copy(work->X, work->K, m * m);
  fbi_copy(work->A, work->M, m * m);
  status = fbi_eig_gen_solve(work->d, work->X, work->A, m);
  if (status != FB_OK) {
    return status;
  }
  while (*rigid < m && work->d[*rigid] <= noise * work->d[m - 1]) {
    (*rigid)++;
  }

  /* The lowest elastic mode must stand out of the round-off */
  if (*rigid > 6 || (*rigid < m && work->d[*rigid] < FB_R(16.0) * noise * work->d[m - 1])) {
    return FB_ERR_CONVERGENCE;
  }
  *shift = *rigid < m ? work->d[*rigid] : FB_R(0.0);
  return FB_OK;
}

/* M x = mu (K + shift M) x: rows of X, d = mu, largest first. */
static fb_status fbi_join_shifted(fb_join_work *work, fb_real shift, int m)
{
  fb_status status;
  for (int i = 0; i < m * m; i++) {
    work->X[i] = work->M[i];
    work->A[i] = work->K[i] + shift * work->M[i];
  }
  status = fbi_eig_gen_solve(work->d, work->X, work->A, m);
  if (status == FB_OK) {
    fbi_eig_turn(work->d, work->X, m);
  }
  return status;
}

/* Elastic modes of the m independent coordinates as in E7.2: rows of X with modal mass 1, d = omega^2 ascending. If K
   is not positive definite, a first solution separates rigid-body modes from the lowest elastic mode, whose omega^2 is
   the shift of the second. */
static fb_status fbi_join_solve(fb_join_work *work, int m, int *found)
{
  fb_real shift = FB_R(0.0), largest;
  int rigid = 0;
  fb_status status = FB_OK;

  /* M x = mu (K + shift M) x */
  if (!fbi_join_is_definite(work, m)) {
    status = fbi_join_rigid(work, &rigid, &shift, m);
  }
  *found = m - rigid;
  if (status == FB_OK && rigid < m) {
    status = fbi_join_shifted(work, shift, m);
  }
  if (status != FB_OK || rigid == m) {
    return status;
  }

  /* omega^2 = 1/mu - shift, modal mass 1; where mu is round-off, modes are massless from there on */
  largest = work->d[0];
  for (int k = 0; k < *found; k++) {
    const fb_real mu = work->d[rigid + k];
    fb_real scale;
    if (!(mu > (fb_real)m * FB_EPSILON * largest)) {
      *found = k;
      break;
    }
    work->d[k] = FB_R(1.0) / mu - shift;
    scale = FB_R(1.0) / FB_SQRT(mu);
    for (int i = 0; i < m; i++) {
      work->X[k * m + i] = scale * work->X[(rigid + k) * m + i];
    }
  }
  return FB_OK;
}

/* Shapes of a component in the first n common modes: its coordinates (rows `at`.. of all) are q = scale Z x. Then its
   share of the common M and K, q^T M q and q^T K q. */
static void fbi_join_expand(fb_modes *out, fb_join_work *work, const fb_modes *component, int at, int n, int m)
{
  fb_real *const q = work->K, *const half = work->M; /* component->n x n each; K and M are not needed any more */
  const int nc = component->n;
  memset(out, 0, sizeof *out);
  out->n = n;
  out->ndof = component->ndof;
  out->joined = 1;

  /* q, and the shapes combined by it */
  for (int a = 0; a < nc; a++) {
    for (int k = 0; k < n; k++) {
      fb_real sum = FB_R(0.0);
      for (int j = 0; j < m; j++) {
        sum += work->Z[(at + a) * m + j] * work->X[k * m + j];
      }
      q[a * n + k] = work->scale[at + a] * sum;
      for (int i = 0; i < out->ndof; i++) {
        out->shape[k * out->ndof + i] += q[a * n + k] * component->shape[a * out->ndof + i];
      }
    }
  }

  /* Share of M and K */
  for (int matrix = 0; matrix < 2; matrix++) {
    const fb_real *const A = matrix ? component->K : component->M;
    fb_real *const to = matrix ? out->K : out->M;
    for (int ak = 0; ak < nc * n; ak++) {
      half[ak] = FB_R(0.0);
      for (int b = 0; b < nc; b++) {
        half[ak] += A[(ak / n) * nc + b] * q[b * n + ak % n];
      }
    }
    for (int kl = 0; kl < n * n; kl++) {
      for (int a = 0; a < nc; a++) {
        to[kl] += q[a * n + kl / n] * half[a * n + kl % n];
      }
    }
  }
}

/* Kind of the component coordinate with the largest share in common mode k; that coordinate is made positive. */
static fb_kind fbi_join_kind(fb_join_work *work, const fb_modes *component, int n_component, int k, int m)
{
  fb_real best = FB_R(0.0), sign = FB_R(1.0);
  fb_kind kind = FB_KIND_BEND_Y;
  int at = 0;
  for (int c = 0; c < n_component; c++) {
    for (int a = 0; a < component[c].n; a++, at++) {
      fb_real sum = FB_R(0.0); /* in units of modal mass */
      for (int j = 0; j < m; j++) {
        sum += work->Z[at * m + j] * work->X[k * m + j];
      }
      if (FB_FABS(sum) > best * (FB_R(1.0) + FBI_ROUNDING)) {
        best = FB_FABS(sum);
        sign = sum < FB_R(0.0) ? -FB_R(1.0) : FB_R(1.0);
        kind = component[c].kind[a];
      }
    }
  }
  for (int j = 0; j < m; j++) {
    work->X[k * m + j] *= sign;
  }
  return kind;
}

/* [E7.12] Component mode synthesis: the rigid connections (welds) T q = 0 are solved by q = Z y; the common modes are
   those of Z^T K Z, Z^T M Z.
   Source: [H] 3.6-14.  Cost: E5.4 twice with the number of free coordinates.  Fails: see the header.
   Test: joined_halves_are_the_whole, joined_components_converge_and_refuse. */
FB_DEF fb_status fb_modes_join(fb_modes *joined, fb_join_work *work, const fb_beam *beam, const fb_modes *component,
                               const fb_join_desc *desc, int n_component)
{
  fb_kind kind[FB_MAX_MODES];
  int N, m, at = 0, found = 0, n = 0;
  fb_real limit;
  fb_status status;
  FBI_REQUIRE(joined && work && beam && component && desc, FB_ERR_NULL);
  status = fbi_join_check(beam, component, desc, n_component);
  if (status != FB_OK) {
    return status;
  }

  /* Constraints eliminated: K = Z^T K Z, M = Z^T M Z */
  N = fbi_join_assemble(work, beam, component, desc, n_component);
  m = N - fbi_null_space(work->Z, work->X, work->pivot, 6 * desc->n_weld, N);
  fbi_congruence(work->K, work->Z, work->A, N, m);
  fbi_congruence(work->M, work->Z, work->A, N, m);

  /* Common modes, n of them up to the limits */
  status = fbi_join_solve(work, m, &found);
  if (status != FB_OK) {
    return status;
  }
  limit = desc->omega_limit > FB_R(0.0) ? desc->omega_limit * desc->omega_limit : FB_HUGE;
  while (n < found && (desc->lowest == 0 || n < desc->lowest) && work->d[n] <= limit) {
    n++;
  }
  if (n > FB_MAX_MODES || (n < desc->lowest && !(desc->omega_limit > FB_R(0.0)))) {
    return n > FB_MAX_MODES ? FBI_REFUSE(FB_ERR_CAPACITY, FBI_WORD_ROOM, -1, (fb_real)n, FB_R(1.0) * FB_MAX_MODES)
                            : FBI_REFUSE(FB_ERR_MODES, "lowest: count of modes that there are, at least", -1,
                                         (fb_real)n, (fb_real)desc->lowest);
  }

  /* Kinds and signs, shapes of each component; joined may be component */
  for (int k = 0; k < n; k++) {
    kind[k] = fbi_join_kind(work, component, n_component, k, m);
  }
  for (int c = 0; c < n_component; c++) {
    const int first = at;
    at += component[c].n;
    fbi_join_expand(&work->joined, work, &component[c], first, n, m);
    memcpy(work->joined.kind, kind, (size_t)n * sizeof *kind);
    for (int k = 0; k < n; k++) {
      work->joined.omega[k] = FB_SQRT(work->d[k]);
    }
    joined[c] = work->joined;
  }
  return FB_OK;
}

/* ---------------------------------------------------------------------------------------------------------------
   BUILD >>assemble: shape integrals, effects to terms, every _init of a model
   (uses config, status, vec3, rotation, solve, body, system, exact, eigen, beam, modes) */

/* ---- shape integrals: an fb_shape holds the inertia shape integrals of a body, its modal stiffness and its nodes */

FB_DEF fb_status fb_shape_init(fb_shape *shape, int n)
{
  FBI_REQUIRE(shape, FB_ERR_NULL);
  FBI_REQUIRE_EXACT();
  FBI_REQUIRE(n >= 0, FB_ERR_VALUE);
  FBI_REQUIRE(n <= FB_MAX_MODES, FB_ERR_CAPACITY);
  memset(shape, 0, sizeof *shape);
  shape->n = n;
  shape->n_node = 1;
  return FB_OK;
}

/* A += -w a^ b^ = w ((a.b) 1 - b a^T) */
static void fbi_add_minus_cross_cross(fb_real A[9], fb_real w, const fb_real a[3], const fb_real b[3])
{
  const fb_real dot = fb_vec3_dot(a, b);
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      A[3 * i + j] += w * ((i == j ? dot : FB_R(0.0)) - b[i] * a[j]);
    }
  }
}

/* The terms of E8.1 with the quadratic (second-order) displacement chi of the pair ab. */
static void fbi_shape_add_quadratic(fb_shape *shape, fb_real m1, fb_real m2, const fb_real r[3], const fb_real chi[3],
                                    int ab)
{
#if FB_WITH_ACCELERATION_STIFFENING
  fb_real cross[3];
  fb_vec3_cross(cross, r, chi);
  fbi_vec3_add(shape->pchi + 3 * ab, m1, chi);
  fbi_vec3_add(shape->hchi + 3 * ab, m2, cross);
#endif
#if FB_WITH_SPIN_STIFFENING
  fbi_add_minus_cross_cross(shape->Gamchi + 9 * ab, m2, chi, r);
#endif
  (void)shape, (void)m1, (void)m2, (void)r, (void)chi, (void)ab;
}

/* [E8.1] Inertia shape integrals (constants of the floating frame of reference formulation) of one mass element.
   m, c = int r, J = -int r^ r^, p_a = int psi_a, h_a = int r x psi_a, M_ab = int psi_a.psi_b, ups_ab = -int psi_a x
   psi_b, Gam_a = -int psi_a^ r^, Pi_ab = -int psi_a^ psi_b^, p^chi_ab = int chi_ab, h^chi_ab = int r x chi_ab,
   Gam^chi_ab = -int chi_ab^ r^.  The linear integrals are weighted by m1, the bilinear ones by m2: a particle has both,
   a direction of spread of a section or a lumped body (E6.2) has m1 = 0.
   Source: [DB] after (4) and (7).  Shapes: psi nb x 3, chi nb x nb x 3 (NULL: none), coordinates first.. of shape.
   Cost: 70 nb^2 flops.  Fails: never.  Test: accelerations_agree_with_a_particle_model. */
static void fbi_shape_add(fb_shape *shape, fb_real m1, fb_real m2, const fb_real r[3], const fb_real *psi,
                          const fb_real *chi, int first, int nb)
{
  const int n = shape->n;

  /* Rigid body */
  shape->mass += m1;
  fbi_vec3_add(shape->c, m1, r);
  fbi_add_minus_cross_cross(shape->J, m2, r, r);

  /* Integrals of one coordinate, then of pairs */
  for (int a = 0; a < nb; a++) {
    const int at = first + a;
    fb_real cross[3];
    fb_vec3_cross(cross, r, psi + 3 * a);
    fbi_vec3_add(shape->P + 3 * at, m1, psi + 3 * a);
    fbi_vec3_add(shape->H + 3 * at, m2, cross);
#if FB_WITH_RESIDUAL_INERTIA
    fbi_add_minus_cross_cross(shape->Gam + 9 * at, m2, psi + 3 * a, r);
#endif
    for (int b = 0; b < nb; b++) {
      const int ab = at * n + first + b;
      shape->M[ab] += m2 * fb_vec3_dot(psi + 3 * a, psi + 3 * b);
#if FB_WITH_SPIN_COUPLING
      fb_vec3_cross(cross, psi + 3 * a, psi + 3 * b);
      fbi_vec3_add(shape->ups + 3 * ab, -m2, cross);
#endif
#if FB_WITH_RESIDUAL_INERTIA
      fbi_add_minus_cross_cross(shape->Pi + 9 * ab, m2, psi + 3 * a, psi + 3 * b);
#endif
      if (chi) {
        fbi_shape_add_quadratic(shape, m1, m2, r, chi + 3 * (a * nb + b), ab);
      }
    }
  }
}

/* Updates the body's largest radius and each mode's largest displacement, for the deflection limit. */
static void fbi_shape_extend(fb_shape *shape, const fb_real r[3], const fb_real *psi, int first, int nb)
{
  shape->size = fbi_larger(shape->size, fbi_vec3_norm(r));
  for (int a = 0; a < nb; a++) {
    shape->reach[first + a] = fbi_larger(shape->reach[first + a], fbi_vec3_norm(psi + 3 * a));
  }
}

FB_DEF fb_status fb_shape_add_particle(fb_shape *shape, fb_real mass, const fb_real r[3], const fb_real *psi,
                                       const fb_real *chi)
{
  FBI_REQUIRE(shape && r && (psi || shape->n == 0), FB_ERR_NULL);
  {
    const fbi_number field[] = {FBI_NOT_NEGATIVE(&mass, 1, "mass [kg]"), FBI_ANY(r, 3, "r [m]"),
                                FBI_ANY(psi, 3 * shape->n, "psi"),
                                FBI_ANY(chi, chi ? 3 * shape->n * shape->n : 0, "chi")};
    const fb_status status = fbi_numbers_check(field, FBI_LENGTH(field), -1);
    if (status != FB_OK) {
      return status;
    }
  }
  fbi_shape_add(shape, mass, mass, r, psi, chi, 0, shape->n);
  fbi_shape_extend(shape, r, psi, 0, shape->n);
  return FB_OK;
}

FB_DEF fb_status fb_shape_add_rigid(fb_shape *shape, fb_real mass, const fb_real center[3], const fb_real inertia[6])
{
  fb_real spread[3][3];
  FBI_REQUIRE(shape && center && inertia, FB_ERR_NULL);
  {
    const fbi_number field[] = {FBI_NOT_NEGATIVE(&mass, 1, "mass [kg]"), FBI_ANY(center, 3, "center [m]"),
                                FBI_ANY(inertia, 6, "inertia [kg m^2]")};
    const fb_status status = fbi_numbers_check(field, FBI_LENGTH(field), -1);
    if (status != FB_OK) {
      return status;
    }
  }
  if (fbi_spread(spread, inertia) != FB_OK) {
    return FBI_REFUSE(FB_ERR_VALUE, FBI_WORD_INERTIA, -1, FB_R(0.0), FB_R(0.0));
  }
  fbi_shape_add(shape, mass, mass, center, NULL, NULL, 0, 0);
  for (int k = 0; k < 3; k++) {
    fbi_shape_add(shape, FB_R(0.0), FB_R(1.0), spread[k], NULL, NULL, 0, 0);
  }
  fbi_shape_extend(shape, center, NULL, 0, 0);
  return FB_OK;
}

/* [E8.2] Quadratic (second-order) displacement field, u = psi q + 1/2 chi q q and rotation vector theta q + 1/2
   chi_theta q q, of a section whose tangent has the transverse components u_y', u_z' exactly and whose stretch and
   twist rate stay LINEAR in q:
   chi_ab = -int (u_y,a' u_y,b' + u_z,a' u_z,b') dx e  (foreshortening),
   chi_theta_ab = 1/2 int (theta_a x theta_b' + theta_b x theta_a').e dx e - 1/2 (phi_a e x theta_b + phi_b e x
   theta_a), phi = theta.e the torsion, e the beam's axis. The strain energy then has no terms of degree 3 but the
   coupling (EI_z - EI_y) phi u_y'' u_z'' of torsion with bending in both planes, which is left out.
   Source: THEORY.md 8.3; exponential map to second degree, kappa = theta' - 1/2 theta x theta'.
   Shapes: the slopes of the two integrals.  Fails: never.
   Test: quadratic_field_is_inextensible_and_twist_free, spinning_beams_stiffen_as_published. */
static void fbi_quadratic_slope(fb_real *shift, fb_real *twist, const fbi_field *a, const fbi_field *b)
{
  *shift = -(a->slope[0] * b->slope[0] + a->slope[1] * b->slope[1]);
  *twist = FB_R(0.5) * (a->theta[1] * b->curvature[2] - a->theta[2] * b->curvature[1] + b->theta[1] * a->curvature[2] -
                        b->theta[2] * a->curvature[1]);
}

/* Weights of the partial integral over an interval, int_0^t f = sum_j w_j f(x_j), from its quadrature points: exact
   to degree 8. */
static void fbi_partial_weights(fb_real w[FBI_GAUSS], fb_real t)
{
  for (int j = 0; j < FBI_GAUSS; j++) {
    w[j] = FB_R(0.0);
    for (int g = 0; g < FBI_GAUSS; g++) {
      const fb_real x = t * fbi_gauss_x[g];
      fb_real lagrange = FB_R(1.0);
      for (int k = 0; k < FBI_GAUSS; k++) {
        lagrange *= k == j ? FB_R(1.0) : (x - fbi_gauss_x[k]) / (fbi_gauss_x[j] - fbi_gauss_x[k]);
      }
      w[j] += t * fbi_gauss_w[g] * lagrange;
    }
  }
}

typedef struct fbi_cell_fields { /* linear fields of all modes at the quadrature points of an interval, element axes */
  fbi_cell cell;
  fb_real axes[9]; /* element axes to body axes */
  fbi_field at[FB_MAX_MODES][FBI_GAUSS];
} fbi_cell_fields;

/* Fields of all modes at the quadrature points of an interval. */
static void fbi_cell_fields_init(fbi_cell_fields *c, const fb_beam *beam, const fb_modes *modes, const fbi_cell *cell)
{
  c->cell = *cell;
  fbi_element_axes(c->axes, beam, cell->element);
  for (int a = 0; a < modes->n; a++) {
    for (int g = 0; g < FBI_GAUSS; g++) {
      fbi_mode_field(&c->at[a][g], beam, modes, a, cell->element, fbi_cell_s(cell, beam, fbi_gauss_x[g]));
    }
  }
}

typedef struct fbi_station { /* the displacement fields of all modes at a point of the reference line, body axes */
  fb_real r[3];
  fb_real u[3 * FB_MAX_MODES], theta[3 * FB_MAX_MODES];
  fb_real chi[3 * FB_MAX_MODES * FB_MAX_MODES], chi_theta[3 * FB_MAX_MODES * FB_MAX_MODES]; /* n x n x 3 */
} fbi_station;

/* Advances the quadratic field (chi, turn = chi_theta) of modes a, b from the beginning of an interval to its
   fraction t, whose partial integral has the weights w (E8.2). */
static void fbi_pair_eval(fb_real chi[3], fb_real turn[3], const fbi_station *st, const fbi_cell_fields *c,
                          const fb_real w[FBI_GAUSS], int a, int b)
{
  const fb_real e[3] = {c->axes[0], c->axes[3], c->axes[6]};
  const fb_real *ta = st->theta + 3 * a, *tb = st->theta + 3 * b;
  const fb_real phi_a = fb_vec3_dot(ta, e), phi_b = fb_vec3_dot(tb, e), dx = c->cell.x1 - c->cell.x0;
  fb_real shift = FB_R(0.0), twist = fb_vec3_dot(turn, e), ea[3], eb[3];

  /* Integrals along the axis e */
  for (int g = 0; g < FBI_GAUSS; g++) {
    fb_real s, r;
    fbi_quadratic_slope(&s, &r, &c->at[a][g], &c->at[b][g]);
    shift += dx * w[g] * s;
    twist += dx * w[g] * r;
  }

  /* Transverse part of the rotation */
  fb_vec3_cross(ea, e, ta);
  fb_vec3_cross(eb, e, tb);
  for (int i = 0; i < 3; i++) {
    chi[i] += shift * e[i];
    turn[i] = twist * e[i] - FB_R(0.5) * (phi_a * eb[i] + phi_b * ea[i]);
  }
}

/* Fields at the fraction t of an interval from those at its beginning, start, which may be st itself. */
static void fbi_station_eval(fbi_station *st, const fb_beam *beam, const fb_modes *modes, const fbi_cell_fields *c,
                             fb_real t, const fbi_station *start)
{
  const int n = modes->n, element = c->cell.element;
  const fb_real x[3] = {c->cell.x0 + t * (c->cell.x1 - c->cell.x0) - beam->start[element], FB_R(0.0), FB_R(0.0)};
  fb_real w[FBI_GAUSS], root[3];

  /* Position */
  fbi_partial_weights(w, t);
  fb_mat33_mul_vec3(st->r, c->axes, x);
  fb_mat33_mul_vec3(root, beam->axes, beam->node + 3 * element);
  fbi_vec3_add(st->r, FB_R(1.0), root);
  fbi_vec3_add(st->r, FB_R(1.0), beam->desc.position);

  /* Linear fields */
  for (int a = 0; a < n; a++) {
    fbi_field f;
    fbi_mode_field(&f, beam, modes, a, element, fbi_cell_s(&c->cell, beam, t));
    fb_mat33_mul_vec3(st->u + 3 * a, c->axes, f.u);
    fb_mat33_mul_vec3(st->theta + 3 * a, c->axes, f.theta);
  }

  /* Quadratic fields, symmetric in a and b */
  for (int a = 0; a < n; a++) {
    for (int b = 0; b <= a; b++) {
      const int ab = 3 * (a * n + b), ba = 3 * (b * n + a);
      fb_real chi[3], turn[3];
      fbi_copy(chi, start->chi + ab, 3);
      fbi_copy(turn, start->chi_theta + ab, 3);
      fbi_pair_eval(chi, turn, st, c, w, a, b);
      fbi_copy(st->chi + ab, chi, 3);
      fbi_copy(st->chi + ba, chi, 3);
      fbi_copy(st->chi_theta + ab, turn, 3);
      fbi_copy(st->chi_theta + ba, turn, 3);
    }
  }
}

/* [E8.3] Displacement of a point d off the reference line, which rotates with the section:
   psi_a += theta_a x d,  chi_ab += chi_theta_ab x d + 1/2 (theta_a x (theta_b x d) + theta_b x (theta_a x d)).
   With linear = 0 only these parts are formed (a direction of spread, E6.2).
   Source: exponential map to second degree.  Shapes: psi n x 3, chi n x n x 3.  Fails: never.
   Test: offset_masses_move_with_their_section. */
static void fbi_offset_field(fb_real *psi, fb_real *chi, const fbi_station *st, const fb_real d[3], int n, int linear)
{
  for (int a = 0; a < n; a++) {
    fb_vec3_cross(psi + 3 * a, st->theta + 3 * a, d);
    fbi_vec3_add(psi + 3 * a, (fb_real)linear, st->u + 3 * a);
  }
  for (int a = 0; a < n; a++) {
    for (int b = 0; b < n; b++) {
      fb_real *x = chi + 3 * (a * n + b);
      fb_real ad[3], bd[3], second[3];
      fb_vec3_cross(ad, st->theta + 3 * a, d);
      fb_vec3_cross(bd, st->theta + 3 * b, d);
      fb_vec3_cross(second, st->theta + 3 * a, bd);
      fbi_vec3_add_cross(second, st->theta + 3 * b, ad);
      fb_vec3_cross(x, st->chi_theta + 3 * (a * n + b), d);
      fbi_vec3_add(x, FB_R(0.5), second);
      fbi_vec3_add(x, (fb_real)linear, st->chi + 3 * (a * n + b));
    }
  }
}

/* Adds a rigid slice at a point of the reference line: a mass at the offset d and directions of spread s_k with
   weights w_k (E6.2), body axes. */
static void fbi_slice_add(fb_shape *shape, const fbi_station *st, int first, int n, fb_real mass, const fb_real d[3],
                          fb_real spread[3][3], const fb_real w[3])
{
  fb_real psi[3 * FB_MAX_MODES], chi[3 * FB_MAX_MODES * FB_MAX_MODES], r[3];
  fbi_copy(r, st->r, 3);
  fbi_vec3_add(r, FB_R(1.0), d);
  fbi_offset_field(psi, chi, st, d, n, 1);
  fbi_shape_add(shape, mass, mass, r, psi, chi, first, n);
  fbi_shape_extend(shape, r, psi, first, n);
  for (int k = 0; k < 3; k++) {
    if (w[k] > FB_R(0.0)) {
      fbi_offset_field(psi, chi, st, spread[k], n, 0);
      fbi_shape_add(shape, FB_R(0.0), w[k], spread[k], psi, chi, first, n);
    }
  }
}

/* Adds the lumped bodies of an element node; st holds the fields there. */
static void fbi_lumps_to_shape(fb_shape *shape, const fb_beam *beam, const fbi_station *st, int node, int first, int n)
{
  for (int k = 0; k < beam->desc.n_lump; k++) {
    const fb_lump *lump = &beam->desc.lump[k];
    const fb_real unit[3] = {FB_R(1.0), FB_R(1.0), FB_R(1.0)};
    fb_real local[3][3], spread[3][3], d[3];
    if (lump->node == node && fbi_spread(local, lump->inertia) == FB_OK) {
      for (int i = 0; i < 3; i++) {
        fb_mat33_mul_vec3(spread[i], beam->axes, local[i]);
      }
      fb_mat33_mul_vec3(d, beam->axes, lump->center);
      fbi_slice_add(shape, st, first, n, lump->mass, d, spread, unit);
    }
  }
}

/* Adds a length dx of beam: its mass at the mass center, its rotary inertia as spread along the section axes (element
   axes y, z rotated by the twist). */
static void fbi_section_to_shape(fb_shape *shape, const fbi_station *st, const fb_section *section,
                                 const fb_real axes[9], fb_real dx, int first, int n)
{
  const fb_real w[3] = {FB_R(0.0), dx * section->i_z, dx * section->i_y};
  fb_real local[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)}, spread[3][3], d[3];
  memset(spread, 0, sizeof spread);
  for (int k = 1; k < 3; k++) {
    fbi_turn_yz(&local[1], &local[2], k == 1 ? FB_R(1.0) : FB_R(0.0), k == 2 ? FB_R(1.0) : FB_R(0.0), -section->twist);
    fb_mat33_mul_vec3(spread[k], axes, local);
  }
  fbi_turn_yz(&local[1], &local[2], section->mass_y, section->mass_z, -section->twist);
  fb_mat33_mul_vec3(d, axes, local);
  fbi_slice_add(shape, st, first, n, dx * section->mass, d, spread, w);
}

static fb_status fbi_shapes_check(const fb_shape *shape, const fb_real r[3], const fb_real *psi, const fb_real *theta)
{
  FBI_REQUIRE(shape && r && ((psi && theta) || shape->n == 0), FB_ERR_NULL);
  {
    const fbi_number field[] = {FBI_ANY(r, 3, "r [m]"), FBI_ANY(psi, 3 * shape->n, "psi"),
                                FBI_ANY(theta, 3 * shape->n, "theta")};
    return fbi_numbers_check(field, FBI_LENGTH(field), -1);
  }
}

FB_DEF fb_status fb_shape_add_lump(fb_shape *shape, fb_real mass, const fb_real r[3], const fb_real *inertia,
                                   const fb_real *psi, const fb_real *theta)
{
  const fb_real none[6] = {FB_R(0.0)}, unit[3] = {FB_R(1.0), FB_R(1.0), FB_R(1.0)};
  fb_real spread[3][3];
  fbi_station st;
  fb_status status = FBI_ENTERED(fbi_shapes_check(shape, r, psi, theta));
  if (status != FB_OK) {
    return status;
  }
  {
    const fbi_number field[] = {FBI_NOT_NEGATIVE(&mass, 1, "mass [kg]"),
                                FBI_ANY(inertia ? inertia : none, 6, "inertia [kg m^2]")};
    status = fbi_numbers_check(field, FBI_LENGTH(field), -1);
    if (status != FB_OK) {
      return status;
    }
  }
  if (fbi_spread(spread, inertia ? inertia : none) != FB_OK) {
    return FBI_REFUSE(FB_ERR_VALUE, FBI_WORD_INERTIA, -1, FB_R(0.0), FB_R(0.0));
  }
  memset(&st, 0, sizeof st);
  fbi_copy(st.r, r, 3);
  fbi_copy(st.u, psi, 3 * shape->n);
  fbi_copy(st.theta, theta, 3 * shape->n);
  fbi_slice_add(shape, &st, 0, shape->n, mass, none, spread, unit);
  return FB_OK;
}

FB_DEF fb_status fb_shape_add_node(fb_shape *shape, int *node, const fb_real r[3], const fb_real *psi,
                                   const fb_real *theta)
{
  const fb_status status = FBI_ENTERED(fbi_shapes_check(shape, r, psi, theta));
  fb_node *out;
  if (status != FB_OK) {
    return status;
  }
  FBI_REQUIRE(node, FB_ERR_NULL);
  if (shape->n_node >= FB_MAX_NODES) {
    return FBI_REFUSE(FB_ERR_CAPACITY, "count of nodes with node 0, FB_MAX_NODES, at most", -1,
                      (fb_real)shape->n_node + FB_R(1.0), FB_R(1.0) * FB_MAX_NODES);
  }
  out = &shape->node[shape->n_node];
  memset(out, 0, sizeof *out);
  fbi_copy(out->r, r, 3);
  fbi_copy(out->psi, psi, 3 * shape->n);
  fbi_copy(out->theta, theta, 3 * shape->n);
  *node = shape->n_node++;
  return FB_OK;
}

/* out[k] = in[coordinate[k]], each `width` reals */
static void fbi_select_rows(fb_real *out, const fb_real *in, int width, const int *coordinate, int n)
{
  for (int k = 0; k < n; k++) {
    fbi_copy(out + width * k, in + width * coordinate[k], width);
  }
}

/* out[k, l] = in[coordinate[k], coordinate[l]], each `width` reals, of n_in x n_in */
static void fbi_select_pairs(fb_real *out, const fb_real *in, int width, const int *coordinate, int n, int n_in)
{
  for (int k = 0; k < n; k++) {
    fbi_select_rows(out + width * k * n, in + width * coordinate[k] * n_in, width, coordinate, n);
  }
}

static void fbi_node_select(fb_node *out, const fb_node *in, const int *coordinate, int n)
{
  memset(out, 0, sizeof *out);
  fbi_copy(out->r, in->r, 3);
  fbi_select_rows(out->psi, in->psi, 3, coordinate, n);
  fbi_select_rows(out->theta, in->theta, 3, coordinate, n);
#if FBI_WITH_QUADRATIC
  for (int k = 0; k < n; k++) { /* triangles: row a begins at a (a + 1)/2 */
    const int to = 3 * (k * (k + 1) / 2), from = 3 * (coordinate[k] * (coordinate[k] + 1) / 2);
    fbi_select_rows(out->chi + to, in->chi + from, 3, coordinate, k + 1);
    fbi_select_rows(out->chi_theta + to, in->chi_theta + from, 3, coordinate, k + 1);
  }
#endif
}

FB_DEF fb_status fb_shape_select(fb_shape *selected, const fb_shape *shape, const int *coordinate, int n)
{
  FBI_REQUIRE(selected && shape && (coordinate || n == 0) && selected != shape, FB_ERR_NULL);
  FBI_REQUIRE(n >= 0 && n <= shape->n, FB_ERR_CAPACITY);
  for (int k = 0; k < n; k++) {
    FBI_REQUIRE(coordinate[k] >= 0 && coordinate[k] < shape->n, FB_ERR_CAPACITY);
    FBI_REQUIRE(k == 0 || coordinate[k] > coordinate[k - 1], FB_ERR_VALUE);
  }

  /* Tables of one coordinate and of pairs; the rest belongs to no coordinate */
  *selected = *shape;
  selected->n = n;
  fbi_select_rows(selected->P, shape->P, 3, coordinate, n);
  fbi_select_rows(selected->H, shape->H, 3, coordinate, n);
  fbi_select_rows(selected->reach, shape->reach, 1, coordinate, n);
  fbi_select_pairs(selected->M, shape->M, 1, coordinate, n, shape->n);
  fbi_select_pairs(selected->K, shape->K, 1, coordinate, n, shape->n);
#if FB_WITH_SPIN_COUPLING
  fbi_select_pairs(selected->ups, shape->ups, 3, coordinate, n, shape->n);
#endif
#if FB_WITH_RESIDUAL_INERTIA
  fbi_select_rows(selected->Gam, shape->Gam, 9, coordinate, n);
  fbi_select_pairs(selected->Pi, shape->Pi, 9, coordinate, n, shape->n);
#endif
#if FB_WITH_SPIN_STIFFENING
  fbi_select_pairs(selected->Gamchi, shape->Gamchi, 9, coordinate, n, shape->n);
#endif
#if FB_WITH_ACCELERATION_STIFFENING
  fbi_select_pairs(selected->pchi, shape->pchi, 3, coordinate, n, shape->n);
  fbi_select_pairs(selected->hchi, shape->hchi, 3, coordinate, n, shape->n);
#endif
#if FB_WITH_NONLINEAR_STRAIN
  fbi_select_rows(selected->slope, shape->slope, 3 * FBI_MAX_STRAINS, coordinate, n);
#if FB_WITH_FORMS
  fbi_select_pairs(selected->torque, shape->torque, 3, coordinate, n, shape->n);
  fbi_select_pairs(selected->torque_boundary, shape->torque_boundary, 3, coordinate, n, shape->n);
#endif
#endif

  /* Nodes */
  for (int j = 0; j < shape->n_node; j++) {
    fbi_node_select(&selected->node[j], &shape->node[j], coordinate, n);
  }
  return FB_OK;
}

FB_DEF fb_status fb_shape_add_pair(fb_shape *shape, int a, int b, const fb_real *pchi, const fb_real *hchi,
                                   const fb_real *Gamchi)
{
  const fb_real none[9] = {FB_R(0.0)};
  const fb_real *const p = pchi ? pchi : none, *const h = hchi ? hchi : none, *const G = Gamchi ? Gamchi : none;
  FBI_REQUIRE(shape, FB_ERR_NULL);
  FBI_REQUIRE(a >= 0 && a < shape->n && b >= 0 && b < shape->n, FB_ERR_CAPACITY);
  {
    const fbi_number field[] = {FBI_ANY(p, 3, "pchi"), FBI_ANY(h, 3, "hchi"), FBI_ANY(G, 9, "Gamchi")};
    const fb_status status = fbi_numbers_check(field, FBI_LENGTH(field), -1);
    if (status != FB_OK) {
      return status;
    }
  }

  /* Both orders of the pair: the tables are symmetric */
  for (int side = 0; side < (a == b ? 1 : 2); side++) {
    const int ab = side ? b * shape->n + a : a * shape->n + b;
#if FB_WITH_ACCELERATION_STIFFENING
    fbi_vec3_add(shape->pchi + 3 * ab, FB_R(1.0), p);
    fbi_vec3_add(shape->hchi + 3 * ab, FB_R(1.0), h);
#endif
#if FB_WITH_SPIN_STIFFENING
    for (int i = 0; i < 9; i++) {
      shape->Gamchi[9 * ab + i] += G[i];
    }
#endif
    (void)ab;
  }
  return FB_OK;
}

/* Is there room for the modes of a beam from coordinate `first` on, and are they modes of this beam? */
static fb_status fbi_beam_fits(const fb_shape *shape, int first, const fb_beam *beam, const fb_modes *modes)
{
  FBI_REQUIRE(shape && beam && modes, FB_ERR_NULL);
  FBI_REQUIRE(first >= 0 && modes->n >= 0 && modes->n <= shape->n && first <= shape->n - modes->n, FB_ERR_CAPACITY);
  FBI_REQUIRE(modes->ndof ==
                  (modes->degree > 0 ? fbi_function_ndof(beam->desc.n_element, modes->degree) : fbi_beam_ndof(beam)),
              FB_ERR_VALUE);
  return FB_OK;
}

#if FBI_WITH_QUADRATIC
/* [E8.32] Start of the quadratic field of a free beam: such that over the mass of the line chi and the rotation about
   the line are zero on average (mass centers off the line add little). The terms of degree 4 that the kinetic energy
   leaves out are then smallest; a field that starts with zero at the root would move the mass center, whose recoil is
   of that degree and much larger.
   Source: int chi dm = 0, the second degree of a mean axis; to some 1e-4 of chi by the quadrature.  Fails: never.
   Test: a_free_beam_swings_as_the_exact_one. */
static void fbi_station_center(fbi_station *st, fbi_cell_fields *fields, const fb_beam *beam, const fb_modes *modes)
{
  const int n = modes->n;
  fbi_cell cell = {0, FB_R(0.0), FB_R(0.0)};
  fb_real outboard = beam->mass; /* int chi dm = int chi' (mass outboard) dx */
  while (fbi_cell_next(&cell, beam)) {
    /* Lumped bodies passed at the beginning of an element */
    fbi_cell_fields_init(fields, beam, modes, &cell);
    for (int k = 0; k < beam->desc.n_lump; k++) {
      const int passed = beam->desc.lump[k].node == cell.element && !(cell.x0 > beam->start[cell.element]);
      outboard -= passed ? beam->desc.lump[k].mass : FB_R(0.0);
    }

    /* Half of the point's mass lies outboard of it */
    for (int g = 0; g < FBI_GAUSS; g++) {
      fb_section section;
      const fb_real e[3] = {fields->axes[0], fields->axes[3], fields->axes[6]},
                    dx = fbi_gauss_w[g] * (cell.x1 - cell.x0);
      fb_beam_section_eval(beam, &section, cell.x0 + fbi_gauss_x[g] * (cell.x1 - cell.x0));
      outboard -= FB_R(0.5) * dx * section.mass;
      for (int ab = 0; ab < n * n; ab++) {
        fb_real slope, twist;
        fbi_quadratic_slope(&slope, &twist, &fields->at[ab / n][g], &fields->at[ab % n][g]);
        fbi_vec3_add(st->chi + 3 * ab, -dx * slope * outboard / beam->mass, e);
        fbi_vec3_add(st->chi_theta + 3 * ab, -dx * twist * outboard / beam->mass, e);
      }
      outboard -= FB_R(0.5) * dx * section.mass;
    }
  }
}
#endif

/* Start of the quadratic field of a beam: zero at a fixed root; at a root that moves with the modes, the field of the
   shape's node that is there and moves with it (E7.12); for a free beam by itself, E8.32. */
static fb_status fbi_station_start(fbi_station *st, fbi_cell_fields *scratch, const fb_shape *shape, int first,
                                   const fb_beam *beam, const fb_modes *modes)
{
  int hangs = 0;
  fb_real u[3 * FB_MAX_MODES], theta[3 * FB_MAX_MODES], size = FB_R(0.0);
  memset(st, 0, sizeof *st);

  /* Motion of the root in each mode, and its size */
  for (int a = 0; a < modes->n; a++) {
    fb_real motion[6] = {FB_R(0.0)};
    if (modes->degree == 0) {
      fbi_weld_motion(motion, beam, modes, a, 0);
    }
    fbi_copy(u + 3 * a, motion, 3);
    fbi_copy(theta + 3 * a, motion + 3, 3);
  }
  for (int i = 0; i < 3 * modes->n; i++) {
    size = fbi_larger(size, fbi_larger(FB_FABS(u[i]), beam->desc.length * FB_FABS(theta[i])));
  }

  /* Node of the shape at the root that moves with it: the field goes on from there */
#if FBI_WITH_QUADRATIC
  for (int k = 1; k < shape->n_node && size > FB_R(0.0); k++) {
    const fb_node *node = &shape->node[k];
    fb_real apart[3], miss;
    fbi_copy(apart, node->r, 3);
    fbi_vec3_add(apart, -FB_R(1.0), beam->desc.position);
    miss = size * fbi_vec3_norm(apart) / beam->desc.length;
    for (int i = 0; i < 3 * modes->n; i++) {
      miss = fbi_larger(miss, FB_FABS(node->psi[3 * first + i] - u[i]));
      miss = fbi_larger(miss, beam->desc.length * FB_FABS(node->theta[3 * first + i] - theta[i]));
    }
    hangs = hangs || miss < FB_R(1e-3) * size;
    for (int ab = 0; ab < modes->n * modes->n && miss < FB_R(1e-3) * size; ab++) {
      const int i = ab / modes->n, j = ab % modes->n, a = first + (i > j ? i : j), b = 2 * first + i + j - a;
      fbi_copy(st->chi + 3 * ab, node->chi + 3 * (a * (a + 1) / 2 + b), 3);
      fbi_copy(st->chi_theta + 3 * ab, node->chi_theta + 3 * (a * (a + 1) / 2 + b), 3);
    }
  }
  if (modes->joined && size > FB_R(0.0) && !hangs) {
    return FB_ERR_VALUE;
  }
  if (beam->desc.root == FB_ROOT_FREE && !hangs) {
    fbi_station_center(st, scratch, beam, modes);
  }
#endif
  (void)shape, (void)first, (void)size, (void)hangs, (void)scratch;
  return FB_OK;
}

#define FBI_WORD_HANGS \
  "modes of a joined component whose root moves, a node of the shape at its root that moves with it"

FB_DEF fb_status fb_shape_add_beam(fb_shape *shape, int first, const fb_beam *beam, const fb_modes *modes)
{
  const fb_status status = FBI_ENTERED(fbi_beam_fits(shape, first, beam, modes));
  fbi_cell cell = {0, FB_R(0.0), FB_R(0.0)};
  fbi_cell_fields fields;
  fbi_station start, st;
  int node = 0;
  if (status != FB_OK) {
    return status;
  }
  if (fbi_station_start(&start, &fields, shape, first, beam, modes) != FB_OK) {
    return FBI_REFUSE(FB_ERR_VALUE, FBI_WORD_HANGS, -1, FB_R(0.0), FB_R(0.0));
  }

  /* Interval by interval; `start` holds the fields at its beginning */
  while (fbi_cell_next(&cell, beam)) {
    fbi_cell_fields_init(&fields, beam, modes, &cell);

    /* Lumped bodies at the first node of an element */
    if (cell.element == node) {
      fbi_station_eval(&st, beam, modes, &fields, FB_R(0.0), &start);
      fbi_lumps_to_shape(shape, beam, &st, node, first, modes->n);
      node++;
    }

    /* Sections at the quadrature points */
    for (int g = 0; g < FBI_GAUSS; g++) {
      fb_section section;
      fb_beam_section_eval(beam, &section, cell.x0 + fbi_gauss_x[g] * (cell.x1 - cell.x0));
      fbi_station_eval(&st, beam, modes, &fields, fbi_gauss_x[g], &start);
      fbi_section_to_shape(shape, &st, &section, fields.axes, fbi_gauss_w[g] * (cell.x1 - cell.x0), first, modes->n);
    }

    /* End of the interval; lumped bodies and reach of the tip */
    fbi_station_eval(&start, beam, modes, &fields, FB_R(1.0), &start);
    if (fbi_cell_is_last(&cell, beam)) {
      fbi_lumps_to_shape(shape, beam, &start, node, first, modes->n);
      fbi_shape_extend(shape, start.r, start.u, first, modes->n);
    }
  }

  /* Stiffness */
  for (int a = 0; a < modes->n; a++) {
    for (int b = 0; b < modes->n; b++) {
      shape->K[(first + a) * shape->n + first + b] += modes->K[a * modes->n + b];
    }
  }
  return FB_OK;
}

FB_DEF fb_status fb_shape_add_beam_node(fb_shape *shape, int *node, int first, const fb_beam *beam,
                                        const fb_modes *modes, fb_real x)
{
  const fb_status status = FBI_ENTERED(fbi_beam_fits(shape, first, beam, modes));
  fbi_cell cell = {0, FB_R(0.0), FB_R(0.0)};
  fbi_cell_fields fields;
  fbi_station st;
  if (status != FB_OK) {
    return status;
  }
  FBI_REQUIRE(node, FB_ERR_NULL);
  if (!fbi_is_finite(&x, 1)) {
    return FBI_REFUSE(FB_ERR_NOT_FINITE, "x [m] along the beam, finite", -1, x, FB_R(0.0));
  }
  if (x < FB_R(0.0) || x > beam->desc.length * (FB_R(1.0) + FB_R(1e-5))) {
    return FBI_REFUSE(FB_ERR_VALUE, "x [m] along the beam, 0 to its length, beyond", -1, x,
                      x < FB_R(0.0) ? FB_R(0.0) : beam->desc.length);
  }

  /* A little beyond the length (a chain's is rounded) is the tip */
  x = x < beam->desc.length ? x : beam->desc.length;
  if (shape->n_node >= FB_MAX_NODES) {
    return FBI_REFUSE(FB_ERR_CAPACITY, "count of nodes with node 0, FB_MAX_NODES, at most", -1,
                      (fb_real)shape->n_node + FB_R(1.0), FB_R(1.0) * FB_MAX_NODES);
  }
  if (fbi_station_start(&st, &fields, shape, first, beam, modes) != FB_OK) {
    return FBI_REFUSE(FB_ERR_VALUE, FBI_WORD_HANGS, -1, FB_R(0.0), FB_R(0.0));
  }

  /* Fields at the beginning of the interval with x, then at x */
  while (fbi_cell_next(&cell, beam)) {
    fbi_cell_fields_init(&fields, beam, modes, &cell);
    if (x <= cell.x1 || fbi_cell_is_last(&cell, beam)) {
      break;
    }
    fbi_station_eval(&st, beam, modes, &fields, FB_R(1.0), &st);
  }
  fbi_station_eval(&st, beam, modes, &fields, (x - cell.x0) / (cell.x1 - cell.x0), &st);

  /* The node */
  {
    fb_node *out = &shape->node[shape->n_node];
    memset(out, 0, sizeof *out);
    fbi_copy(out->r, st.r, 3);
    fbi_copy(out->psi + 3 * first, st.u, 3 * modes->n);
    fbi_copy(out->theta + 3 * first, st.theta, 3 * modes->n);
#if FBI_WITH_QUADRATIC
    for (int a = 0; a < modes->n; a++) {
      for (int b = 0; b <= a; b++) {
        const int pair = 3 * ((first + a) * (first + a + 1) / 2 + first + b), ab = 3 * (a * modes->n + b);
        fbi_copy(out->chi + pair, st.chi + ab, 3);
        fbi_copy(out->chi_theta + pair, st.chi_theta + ab, 3);
      }
    }
#endif
  }
  *node = shape->n_node++;
  return FB_OK;
}

/* [E8.31] Axial strain at a point y, z of a section, linear in the coordinates: u_x' + z theta_y' - y
   theta_z'.
   Source: plane sections.  Shapes: gain n.  Fails: see the header.  Test: a_strain_gauge_reads_the_bending_moment. */
FB_DEF fb_status fb_gauge_init(fb_gauge *gauge, int first, const fb_beam *beam, const fb_modes *modes, fb_real x,
                               fb_real y, fb_real z)
{
  fbi_cell cell = {0, FB_R(0.0), FB_R(0.0)};
  FBI_REQUIRE(gauge && beam && modes, FB_ERR_NULL);
  FBI_REQUIRE(modes->n >= 0 && modes->n <= FB_MAX_MODES && first >= 0 && first <= FB_MAX_MODES - modes->n,
              FB_ERR_CAPACITY);
  if (!fbi_is_finite(&x, 1) || !fbi_is_finite(&y, 1) || !fbi_is_finite(&z, 1)) {
    return FB_ERR_NOT_FINITE;
  }
  if (x < FB_R(0.0) || x > beam->desc.length * (FB_R(1.0) + FB_R(1e-5))) {
    return FBI_REFUSE(FB_ERR_VALUE, "x [m] along the beam, 0 to its length, beyond", -1, x,
                      x < FB_R(0.0) ? FB_R(0.0) : beam->desc.length);
  }

  /* Interval with x */
  while (fbi_cell_next(&cell, beam) && x > cell.x1 && !fbi_cell_is_last(&cell, beam)) {
  }

  /* Strain by each mode */
  memset(gauge, 0, sizeof *gauge);
  gauge->n = first + modes->n;
  for (int a = 0; a < modes->n; a++) {
    const fb_real s = (fbi_larger(cell.x0, x < cell.x1 ? x : cell.x1) - cell.x0) / (cell.x1 - cell.x0);
    fbi_field f;
    fbi_mode_field(&f, beam, modes, a, cell.element, fbi_cell_s(&cell, beam, s));
    gauge->gain[first + a] = f.strain + z * f.curvature[1] - y * f.curvature[2];
  }
  return FB_OK;
}

#if FB_WITH_FORMS && FB_WITH_NONLINEAR_STRAIN
/* [E8.24] Stiffness torque as printed, its part of degree 1: g_s,3 = int (EA u_x' u_y' - EI_z u_x'' u_y'') dx,
   g_s,2 = -int (EA u_x' u_z' - EI_y u_x'' u_z'') dx; different EI add g_s,1 = (EI_z - EI_y) int u_y'' u_z'' dx.
   At the root of a clamped beam the integration by parts leaves -u_x'(0) EI_z u_y''(0) in g_s,3, + .. u_z''(0) in
   g_s,2.
   Source: [DB] (34)-(36) with ERRATA.md DB9 and DBc.  Shapes: n x n x 3.  Fails: never.
   Test: stiffness_torques_agree_on_a_closed_basis, spin_up_follows_the_references_of_each_form. */
static void fbi_torque_add(fb_real g[3], const fbi_field *x, const fbi_field *b, fb_real EA, fb_real EI_y, fb_real EI_z)
{
  g[0] -= (EI_z - EI_y) * x->curvature[2] * b->curvature[1];
  g[1] -= -EA * x->strain * b->theta[1] + EI_y * x->strain_slope * b->curvature[1];
  g[2] += EA * x->strain * b->theta[2] - EI_z * x->strain_slope * b->curvature[2];
}

/* Adds E8.24 at a quadrature point; torque_unknown: the printed torque does not cover this beam. */
static void fbi_torque_station(fb_shape *shape, int first, const fb_beam *beam, const fb_modes *modes,
                               const fb_section *section, int element, fb_real s, fb_real dx)
{
  const int n = modes->n;
  fbi_field f[FB_MAX_MODES];
  shape->torque_unknown |= /* not covered: section axes that differ from the beam's */
      FB_FABS(section->twist) + FB_FABS(section->tension_y) + FB_FABS(section->tension_z) > FB_R(0.0);
  for (int a = 0; a < n; a++) {
    fbi_mode_field(&f[a], beam, modes, a, element, s);
  }
  for (int ab = 0; ab < n * n; ab++) {
    const int at = 3 * ((first + ab / n) * shape->n + first + ab % n);
    fbi_torque_add(shape->torque + at, &f[ab / n], &f[ab % n], dx * section->EA, dx * section->EI_y,
                   dx * section->EI_z);
  }
}

/* Adds the boundary term of E8.24 at the root. */
static void fbi_torque_root(fb_shape *shape, int first, const fb_beam *beam, const fb_modes *modes)
{
  const int n = modes->n;
  fb_section section;
  fbi_field f[FB_MAX_MODES];
  fb_beam_section_eval(beam, &section, FB_R(0.0));
  for (int a = 0; a < n; a++) {
    fbi_mode_field(&f[a], beam, modes, a, 0, FB_R(0.0));
  }
  for (int ab = 0; ab < n * n; ab++) {
    fb_real *g = shape->torque_boundary + 3 * ((first + ab / n) * shape->n + first + ab % n);
    g[1] -= f[ab / n].strain * section.EI_y * f[ab % n].curvature[1];
    g[2] -= f[ab / n].strain * section.EI_z * f[ab % n].curvature[2];
  }
  shape->torque_unknown |= modes->degree == 0;
  for (int i = 0; i < 9; i++) { /* terms of higher degree are not rotated to body axes */
    shape->torque_unknown |= FB_FABS(beam->axes[i] - (i % 4 == 0 ? FB_R(1.0) : FB_R(0.0))) > FBI_ROUNDING;
  }
}
#endif

#if FB_WITH_NONLINEAR_STRAIN
/* Number of intervals between stations and elements; each needs axial stiffness at both ends. */
static fb_status fbi_strain_intervals(int *intervals, const fb_beam *beam)
{
  fbi_cell cell = {0, FB_R(0.0), FB_R(0.0)};
  *intervals = 0;
  while (fbi_cell_next(&cell, beam)) {
    fb_section ends[2];
    fb_beam_section_eval(beam, &ends[0], cell.x0);
    fb_beam_section_eval(beam, &ends[1], cell.x1);
    if (!(ends[0].EA > FB_R(0.0) && ends[1].EA > FB_R(0.0))) {
      return FB_ERR_KIND;
    }
    (*intervals)++;
  }
  return FB_OK;
}

/* Distance |r| of a point of an element's axis from the body frame's origin. */
static fb_real fbi_beam_distance(const fb_beam *beam, int element, fb_real x)
{
  const fb_real at[3] = {x - beam->start[element], FB_R(0.0), FB_R(0.0)};
  fb_real r[3], local[3];
  fb_mat33_mul_vec3(local, beam->frame + 9 * element, at);
  fbi_vec3_add(local, FB_R(1.0), beam->node + 3 * element);
  fb_mat33_mul_vec3(r, beam->axes, local);
  fbi_vec3_add(r, FB_R(1.0), beam->desc.position);
  return fbi_vec3_norm(r);
}

/* Axial strain u_x' and slopes u_y', u_z' by each mode at quadrature point n, at s in an element. */
static void fbi_strain_point(fb_shape *shape, int first, const fb_beam *beam, const fb_modes *modes,
                             const fb_section *section, int element, fb_real s, int n)
{
  for (int a = 0; a < modes->n; a++) {
    fb_real *slope = shape->slope + 3 * (first + a) * FBI_MAX_STRAINS + n;
    fbi_field f;
    fbi_section_field at_center;
    fbi_mode_field(&f, beam, modes, a, element, s);
    fbi_section_eval(&at_center, &f, section);
    slope[0] = at_center.strain;
    slope[FBI_MAX_STRAINS] = f.slope[0];
    slope[2 * FBI_MAX_STRAINS] = f.slope[1];
  }
}

FB_DEF fb_status fb_shape_add_beam_strain(fb_shape *shape, int first, const fb_beam *beam, const fb_modes *modes)
{
  const int points = modes && modes->degree > 0 ? 2 * modes->degree - 1 : FBI_GAUSS; /* exact for slopes^4 */
  fb_real x[FBI_RULE], w[FBI_RULE], moment = FB_R(0.0), softest = FB_HUGE;
  fbi_cell cell = {0, FB_R(0.0), FB_R(0.0)};
  int n, intervals = 0;
  fb_status status = FBI_ENTERED(fbi_beam_fits(shape, first, beam, modes));
  status = status ? status : fbi_strain_intervals(&intervals, beam);
  if (status != FB_OK) {
    return status;
  }
  if (shape->n_strain + (intervals * points + 3) / 4 * 4 > FBI_MAX_STRAINS) {
    return FB_ERR_CAPACITY;
  }

  /* Quadrature points of every interval: weight EA dx; int mass |r| dx and the least EA */
  fbi_gauss_rule(x, w, points);
  n = shape->n_strain;
  while (fbi_cell_next(&cell, beam)) {
    for (int g = 0; g < points; g++, n++) {
      const fb_real dx = w[g] * (cell.x1 - cell.x0), s = fbi_cell_s(&cell, beam, x[g]);
      fb_section section;
      fb_beam_section_eval(beam, &section, cell.x0 + x[g] * (cell.x1 - cell.x0));
      moment += dx * section.mass * fbi_beam_distance(beam, cell.element, section.x);
      softest = section.EA < softest ? section.EA : softest;
      shape->strain_weight[n] = dx * section.EA;
      fbi_strain_point(shape, first, beam, modes, &section, cell.element, s, n);
#if FB_WITH_FORMS
      fbi_torque_station(shape, first, beam, modes, &section, cell.element, s, dx);
#endif
    }
  }

  /* Bound of the centrifugal strain by omega^2: (int mass |r| dx, with the lumped bodies) / least EA */
  for (int k = 0; k < beam->desc.n_lump; k++) {
    moment += beam->desc.lump[k].mass * (fbi_vec3_norm(beam->desc.position) + beam->desc.length);
  }
  shape->stretch = fbi_larger(shape->stretch, moment / softest);
#if FB_WITH_FORMS
  fbi_torque_root(shape, first, beam, modes);
#endif
  shape->n_strain = (n + 3) / 4 * 4; /* padded to groups of four with weight 0 */
  return FB_OK;
}
#endif

/* ---- effects to terms */

/* [E8.4] Coupling matrices Lambda(q) = Lambda_0 + sum_a q_a Lambda_a (6 x n each), a = 0 first:
   Lambda_0 = [P; H],  Lambda_a = [P^chi_a ; H^chi_a - Ups_a],  Ups_a = row_b{ups_ab}:
   M_re(q) of the second-order form, the momenta of the modes on the deformed body. ups enters with the spin
   (gyroscopic, Coriolis) coupling, chi with the acceleration stiffening.
   Source: THEORY.md 8.2, 8.3; [DB] (7), (25).  Shapes: Lambda (n+1) x 6 x n.  Fails: never.
   Test: accelerations_agree_with_a_particle_model. */
static void fbi_lambda_fill(fb_real *Lambda, const fb_shape *shape, int n, int with_ups, int with_chi)
{
  fbi_zero(Lambda, (n + 1) * 6 * n);
  for (int b = 0; b < n; b++) {
    for (int i = 0; i < 3; i++) {
      Lambda[i * n + b] = shape->P[3 * b + i];
      Lambda[(3 + i) * n + b] = shape->H[3 * b + i];
      for (int a = 0; a < n; a++) {
        const int ab = 3 * (a * n + b) + i;
        fb_real *row = Lambda + ((a + 1) * 6 + i) * n + b;
#if FB_WITH_ACCELERATION_STIFFENING
        row[0] += with_chi ? shape->pchi[ab] : FB_R(0.0);
        row[3 * n] += with_chi ? shape->hchi[ab] : FB_R(0.0);
#endif
#if FB_WITH_SPIN_COUPLING
        row[3 * n] -= with_ups ? shape->ups[ab] : FB_R(0.0);
#endif
        (void)row, (void)ab, (void)with_chi, (void)with_ups;
      }
    }
  }
}

#if FB_WITH_ACCELERATION_STIFFENING
/* Magnitude against which element ab of a quadratic-field integral x (n x n x 3) is judged as round-off. */
static fb_real fbi_chi_size(const fb_real *x, int n, int a, int b)
{
  return fbi_vec3_norm(x + 3 * (a * n + b)) +
         FB_SQRT(fbi_vec3_norm(x + 3 * (a * n + a)) * fbi_vec3_norm(x + 3 * (b * n + b)));
}
#endif

/* Magnitude against which element i of Lambda_a for mode b is judged as round-off: bounds of the integrals in it. */
static fb_real fbi_lambda_size(const fb_shape *shape, int i, int a, int b)
{
  const int n = shape->n;
  const fb_real mb = FB_SQRT(shape->M[b * n + b]);
  fb_real size;
  if (a == 0) {
    return mb * FB_SQRT(i < 3 ? shape->mass : shape->J[0] + shape->J[4] + shape->J[8]);
  }
  a--;
  size = i < 3 ? FB_R(0.0) : mb * FB_SQRT(shape->M[a * n + a]);
#if FB_WITH_ACCELERATION_STIFFENING
  size += fbi_chi_size(i < 3 ? shape->pchi : shape->hchi, n, a, b);
#endif
  return size;
}

/* Appends element (i, b) of -Lambda_a to the list unless it is round-off. */
static void fbi_lambda_list_term(fb_body *body, const fb_shape *shape, const fb_real *Lambda, int i, int a, int b)
{
  const fb_real value = Lambda[(a * 6 + i) * body->n + b];
  if (FB_FABS(value) > FBI_ROUNDING * fbi_lambda_size(shape, i, a, b)) {
    if (body->n_lambda < FBI_MAX_LAMBDA) {
      fb_lambda_term *term = &body->lambda[body->n_lambda];
      term->c = -value;
      term->i = (unsigned short)i;
      term->a = (unsigned short)a;
      term->b = (unsigned short)b;
    }
    body->n_lambda++; /* counted beyond the capacity, too: the caller checks it */
  }
}

/* Lists the terms of -Lambda. Constant ones first, those of the linear momentum before those of the angular one, with
   alternating rows so that successive sums are independent. Then those linear in q, row by row: there are more of
   them, and a row's sum stays in a register. */
static void fbi_lambda_list(fb_body *body, const fb_shape *shape, const fb_real *Lambda)
{
  const int n = body->n;
  body->n_lambda = body->n_linear_constant = body->n_linear = body->n_row = 0;

  /* Constant terms */
  for (int half = 0; half < 6; half += 3) {
    for (int b = 0; b < n; b++) {
      for (int i = half; i < half + 3; i++) {
        fbi_lambda_list_term(body, shape, Lambda, i, 0, b);
      }
    }
    body->n_linear_constant = half == 0 ? body->n_lambda : body->n_linear_constant;
  }
  body->n_lambda_constant = body->n_lambda;

  /* Terms linear in q */
  for (int i = 0; i < 6; i++) {
    const int before = body->n_lambda;
    for (int a = 1; a <= n; a++) {
      for (int b = 0; b < n; b++) {
        fbi_lambda_list_term(body, shape, Lambda, i, a, b);
      }
    }
    if (body->n_lambda > before) {
      body->lambda_row[body->n_row].i = (unsigned short)i;
      body->lambda_row[body->n_row++].end = (unsigned short)body->n_lambda;
    }
    body->n_linear = i == 2 ? body->n_lambda - body->n_lambda_constant : body->n_linear;
  }
}

/* Packed 6x6 of blocks [m 1, -c^; c^, J] from m, c and the symmetric part of J. */
static void fbi_rigid_matrix(fb_real S[21], fb_real m, const fb_real c[3], const fb_real J[9])
{
  fbi_zero(S, 21);
  S[0] = S[6] = S[11] = m;
  S[4] = c[2]; /* rows v, columns w: -c^ */
  S[5] = -c[1];
  S[8] = -c[2];
  S[10] = c[0];
  S[12] = c[1];
  S[13] = -c[0];
  for (int i = 0; i < 3; i++) {
    for (int j = i; j < 3; j++) {
      S[fb_sym6_index(3 + i, 3 + j)] = FB_R(0.5) * (J[3 * i + j] + J[3 * j + i]);
    }
  }
}

#if FB_WITH_RESIDUAL_INERTIA || FB_WITH_SPIN_STIFFENING
/* A += s B for 3x3 */
static void fbi_vec9_add(fb_real A[9], fb_real s, const fb_real B[9])
{
  for (int i = 0; i < 9; i++) {
    A[i] += s * B[i];
  }
}
#endif

/* [E8.5] Rigid part of S: M_rr(q) = [m 1, -c(q)^; c(q)^, J(q)], coefficient of the monomial (1,q)_a (1,q)_b, a >= b:
   c(q) = c + p_a q_a + 1/2 p^chi_ab q_a q_b,  J(q) = J + (Gam_a + Gam_a^T) q_a + (Pi_ab + 1/2 (Gam^chi_ab + ^T)) q_a
   q_b. p_a, Gam_a, Pi_ab belong to the residual (configuration-dependent) inertia, Gam^chi to the spin (centrifugal)
   stiffening, p^chi to the acceleration stiffening.
   Source: [DB] after (4), THEORY.md 8.3.  Shapes: S packed 21.  Fails: never.
   Test: accelerations_agree_with_a_particle_model. */
static void fbi_rigid_term(fb_real S[21], const fb_shape *shape, unsigned effects, int a, int b)
{
  const int ab = (a - 1) * shape->n + b - 1;
  const fb_real twice = a == b ? FB_R(1.0) : FB_R(2.0); /* ab and ba */
  fb_real c[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)}, J[9] = {0}, m = FB_R(0.0);

  /* Degree 0, then what each effect adds */
  if (a == 0) {
    m = shape->mass;
    fbi_copy(c, shape->c, 3);
    fbi_copy(J, shape->J, 9);
  }
#if FB_WITH_RESIDUAL_INERTIA
  if (a > 0 && b == 0 && fbi_has(effects, FB_EFFECT_RESIDUAL_INERTIA)) {
    fbi_copy(c, shape->P + 3 * (a - 1), 3);
    fbi_vec9_add(J, FB_R(2.0), shape->Gam + 9 * (a - 1));
  }
  if (a > 0 && b > 0 && fbi_has(effects, FB_EFFECT_RESIDUAL_INERTIA)) {
    fbi_vec9_add(J, twice, shape->Pi + 9 * ab);
  }
#endif
#if FB_WITH_SPIN_STIFFENING
  if (a > 0 && b > 0 && fbi_has(effects, FB_EFFECT_SPIN_STIFFENING)) {
    fbi_vec9_add(J, twice, shape->Gamchi + 9 * ab);
  }
#endif
#if FB_WITH_ACCELERATION_STIFFENING
  if (a > 0 && b > 0 && fbi_has(effects, FB_EFFECT_ACCELERATION_STIFFENING)) {
    fbi_vec3_add(c, FB_R(0.5) * twice, shape->pchi + 3 * ab);
  }
#endif
  (void)effects, (void)ab, (void)twice;
  fbi_rigid_matrix(S, m, c, J);
}

/* Magnitude against which element (i, j) of S of a pair is judged as round-off: bounds of its rigid and elastic
   parts. */
static fb_real fbi_S_size(const fb_shape *shape, const fb_real *Z, int a, int b, int i, int j)
{
  const int n = shape->n;
  const fb_real J = FB_SQRT(shape->J[0] + shape->J[4] + shape->J[8]);
  const fb_real m = FB_SQRT(shape->mass);
  const fb_real *const Za = Z + 6 * a * n, *const Zb = Z + 6 * b * n;
  fb_real size = FB_R(0.0);
  if (j >= 3 && (i >= 3 || b == 0)) {
    const fb_real sa = a > 0 ? FB_SQRT(shape->M[(a - 1) * n + a - 1]) : J;
    const fb_real sb = b > 0 ? FB_SQRT(shape->M[(b - 1) * n + b - 1]) : (i < 3 ? m : J);
    size = sa * sb;
  }
#if FB_WITH_ACCELERATION_STIFFENING
  if (j >= 3 && i < 3 && b > 0) {
    size = fbi_chi_size(shape->pchi, n, a - 1, b - 1);
  }
#endif
  return size + FB_SQRT(fbi_dot(Za + i * n, Za + i * n, n)) * FB_SQRT(fbi_dot(Zb + j * n, Zb + j * n, n)) +
         FB_SQRT(fbi_dot(Zb + i * n, Zb + i * n, n)) * FB_SQRT(fbi_dot(Za + j * n, Za + j * n, n));
}

/* [E8.6] Coefficient of a pair in the Schur complement S(q) = M_rr(q) - Lambda(q) M^-1 Lambda(q)^T. With M = L L^T and
   Z_a = Lambda_a L^-T it is the pair's part of M_rr less Z_a Z_b^T + Z_b Z_a^T (once for a = b); round-off
   is set to zero. It is S_0 + [0 D1; D1^T D2] of THEORY.md 8.2 in one polynomial. Without residual inertia the caller
   leaves ups out of Z. Returns 1 where anything is left.
   Source: THEORY.md 8.2, 8.3.  Shapes: S packed 21, Z (n+1) x 6 x n.  Cost: 42 n.  Fails: never.
   Test: residual_inertia_vanishes_on_a_rotation_closed_basis, accelerations_agree_with_a_particle_model. */
static int fbi_S_coefficient(fb_real S[21], const fb_body *body, const fb_shape *shape, const fb_real *Z, int a, int b)
{
  const int n = body->n;
  int any = 0;
  fbi_rigid_term(S, shape, body->effects, a, b);
  for (int i = 0; i < 6; i++) {
    for (int j = i; j < 6; j++) {
      const int at = fb_sym6_index(i, j);
      for (int k = 0; k < n; k++) {
        S[at] -= Z[(a * 6 + i) * n + k] * Z[(b * 6 + j) * n + k];
        S[at] -= a == b ? FB_R(0.0) : Z[(b * 6 + i) * n + k] * Z[(a * 6 + j) * n + k];
      }
      if (a > 0 && FB_FABS(S[at]) <= FBI_ROUNDING * fbi_S_size(shape, Z, a, b, i, j)) {
        S[at] = FB_R(0.0);
      }
      any |= S[at] != FB_R(0.0);
    }
  }
  return any;
}

#if FBI_WITH_SHAPE_INERTIA
/* Bit pattern of the elements of a coefficient that are not zero. */
static unsigned long fbi_S_pattern(const fb_real S[21])
{
  unsigned long pattern = 0;
  for (int i = 0; i < 21; i++) {
    pattern = 2 * pattern + (S[i] != FB_R(0.0));
  }
  return pattern;
}

/* Inserts a pair among those from `first` on, in the order of their patterns: an element then runs through many
   consecutive pairs. */
static void fbi_S_insert(fb_body *body, fb_real S[][21], int first, const fb_real coefficient[21], int a, int b)
{
  int at = body->n_pair++;
  for (; at > first && fbi_S_pattern(S[at - 1]) > fbi_S_pattern(coefficient); at--) {
    fbi_copy(S[at], S[at - 1], 21);
    body->pair[at] = body->pair[at - 1];
  }
  fbi_copy(S[at], coefficient, 21);
  body->pair[at].a = (unsigned short)a;
  body->pair[at].b = (unsigned short)b;
}

/* Lists the coefficients of the pairs from `first` on element by element, as runs of consecutive pairs. */
static void fbi_S_list_runs(fb_body *body, fb_real S[][21], int first)
{
  for (int i = 0; i < 21; i++) {
    int inside = 0;
    for (int k = first; k < body->n_pair; k++) {
      const int begins = S[k][i] != FB_R(0.0) && !inside;
      inside = S[k][i] != FB_R(0.0);
      body->n_run += begins;
      body->n_S += inside;
      if (inside && body->n_S <= FBI_MAX_S && body->n_run <= FBI_MAX_RUNS) {
        fb_S_run *run = &body->run[body->n_run - 1];
        run->i = (unsigned short)i;
        run->pair = begins ? (unsigned short)k : run->pair;
        run->n = (unsigned short)(begins ? 1 : run->n + 1);
        body->S[body->n_S - 1] = S[k][i];
      } /* counted beyond the capacity, too: the caller checks it */
    }
  }
}

/* Lists the pairs a0 (degree 1) or ab (degree 2) that are not zero, and their runs. */
static void fbi_S_list_degree(fb_body *body, fb_body_work *work, const fb_shape *shape, int degree)
{
  const int first = body->n_pair;
  for (int a = 1; a <= body->n; a++) {
    for (int b = degree == 1 ? 0 : 1; b <= (degree == 1 ? 0 : a); b++) {
      fb_real S[21];
      if (fbi_S_coefficient(S, body, shape, work->Lambda, a, b)) {
        fbi_S_insert(body, work->S, first, S, a, b);
      }
    }
  }
  fbi_S_list_runs(body, work->S, first);
}
#endif

/* Lists S(q), ascending in degree: the constant part, the pairs a0, the pairs ab. Returns the number of runs of
   degree 1. */
static int fbi_S_list(fb_body *body, fb_body_work *work, const fb_shape *shape)
{
  int linear = 0;
  body->n_S = body->n_run = body->n_pair = 0;
  (void)fbi_S_coefficient(body->S0, body, shape, work->Lambda, 0, 0);
#if FBI_WITH_SHAPE_INERTIA
  if (!body->constant_S) {
    fbi_S_list_degree(body, work, shape, 1);
    linear = body->n_run;
    fbi_S_list_degree(body, work, shape, 2);
  }
#endif
  return linear;
}

/* Sparse form of the symmetric A (n x n): its diagonal and the elements that are not round-off against it. */
static void fbi_sparse_fill(fb_sparse *out, const fb_real *A, int n)
{
  out->n_term = 0;
  for (int a = 0; a < n; a++) {
    out->diagonal[a] = A[a * n + a];
    for (int b = 0; b < a; b++) {
      const fb_real size = FB_SQRT(FB_FABS(A[a * n + a])) * FB_SQRT(FB_FABS(A[b * n + b]));
      if (FB_FABS(A[a * n + b]) > FBI_ROUNDING * size) {
        fb_pair_term *term = &out->term[out->n_term++];
        term->c = A[a * n + b];
        term->a = (unsigned short)a;
        term->b = (unsigned short)b;
      }
    }
  }
}

#if FB_WITH_DAMPING
/* [E8.7] Damping force C q_dot with the modal ratios zeta_k: C = sum_k 2 zeta_k omega_k (M x_k)(M x_k)^T.
   For normalized modes C = diag(2 zeta omega). It depends on the deformation rate alone and takes no momentum.
   Source: textbook.  Shapes: C n x n.  Fails: K indefinite.  Test: damped_free_decay_has_the_given_ratio. */
static fb_status fbi_damping_fill(fb_body *body, fb_body_work *work, const fb_shape *shape, const fb_real *zeta)
{
  const int n = body->n;
  fb_real *C = work->L; /* free until M is factored */
  fb_status status;
  if (!fbi_has(body->effects, FB_EFFECT_DAMPING)) {
    return FB_OK;
  }

  /* Normalized modes: C is diagonal */
  if (body->unit_mass && body->K.n_term == 0) {
    for (int k = 0; k < n; k++) {
      body->C.diagonal[k] = FB_R(2.0) * zeta[k] * FB_SQRT(body->K.diagonal[k]);
    }
    return FB_OK;
  }

  /* Modes x_k of M and K */
  fbi_zero(C, n * n);
  fbi_copy(work->A, shape->K, n * n);
  fbi_copy(work->B, shape->M, n * n);
  status = fb_eig_gen_solve(work->d, work->X, work->A, work->B, n);

  /* Sum over the modes */
  for (int k = 0; status == FB_OK && k < n; k++) {
    const fb_real factor = FB_R(2.0) * zeta[k] * FB_SQRT(fbi_larger(work->d[k], FB_R(0.0)));
    for (int i = 0; i < n; i++) { /* row k of A: M x_k */
      work->A[i] = FB_R(0.0);
      for (int j = 0; j < n; j++) {
        work->A[i] += shape->M[i * n + j] * work->X[k * n + j];
      }
    }
    for (int a = 0; a < n; a++) {
      for (int b = 0; b < n; b++) {
        C[a * n + b] += factor * work->A[a] * work->A[b];
      }
    }
  }
  fbi_sparse_fill(&body->C, C, n);
  return status;
}
#endif

/* Largest eigenvalue of A x = d B x, or 0, with A = work.A, which is overwritten; B is kept. */
static fb_status fbi_largest_eigenvalue(fb_real *largest, fb_body_work *work, const fb_real *B, int n)
{
  fb_status status = FB_OK;
  *largest = FB_R(0.0);
  if (n > 0) {
    fbi_copy(work->B, B, n * n);
    status = fb_eig_gen_solve(work->d, work->X, work->A, work->B, n);
    *largest = fbi_larger(*largest, status == FB_OK ? work->d[n - 1] : FB_R(0.0));
  }
  return status;
}

#if FBI_WITH_QUADRATIC
/* Bound of the norm against B of sum_i x_i T_i for unit vectors x: the root of the largest eigenvalue of sum_i T_i^T
   B^-1 T_i against B, T_i(a,b) = table[m (a n + b) + i], i < m. */
static fb_status fbi_table_norm(fb_real *norm, fb_body_work *work, const fb_real *table, int m, const fb_real *B, int n)
{
  fb_status status = FB_OK;
  fb_real largest = FB_R(0.0);

  /* B = L L^T */
  fbi_copy(work->L, B, n * n);
  if (n > 0) {
    status = fb_chol_factor(work->L, n);
  }

  /* A = sum_i T_i^T B^-1 T_i */
  fbi_zero(work->A, n * n);
  for (int i = 0; status == FB_OK && i < m; i++) {
    for (int a = 0; a < n; a++) { /* row a of X: L^-1 T_i e_a */
      for (int b = 0; b < n; b++) {
        work->X[a * n + b] = table[m * (b * n + a) + i];
      }
      fbi_chol_forward(work->X + a * n, work->L, work->X + a * n, n);
    }
    for (int ab = 0; ab < n * n; ab++) {
      for (int k = 0; k < n; k++) {
        work->A[ab] += work->X[(ab / n) * n + k] * work->X[(ab % n) * n + k];
      }
    }
  }

  /* Largest eigenvalue against B */
  if (status == FB_OK) {
    status = fbi_largest_eigenvalue(&largest, work, B, n);
  }
  *norm = FB_SQRT(largest);
  return status;
}
#endif

#if FB_WITH_NONLINEAR_STRAIN
/* Strain and slopes at the quadrature points for the nonlinear axial strain: the rows that are not zero, and the
   degrees of the strain energy that truncation keeps. */
static void fbi_strain_fill(fb_body *body, const fb_shape *shape, fb_truncation truncation)
{
  body->n_strain = 0;
  body->n_strain_row = 0;
  body->quartic = truncation == FB_TRUNCATE_ABOVE_1 ? FB_R(0.0) : FB_R(1.0);
  if (!fbi_has(body->effects, FB_EFFECT_NONLINEAR_STRAIN)) {
    return;
  }

  /* Rows of all coordinates */
  body->n_strain = shape->n_strain;
  fbi_copy(body->strain_weight, shape->strain_weight, FBI_MAX_STRAINS);
  for (int i = 0; i < 3 * body->n; i++) {
    const fb_real *slope = shape->slope + i * FBI_MAX_STRAINS;
    fb_real largest = FB_R(0.0);
    for (int g = 0; g < body->n_strain; g++) {
      largest = fbi_larger(largest, FB_FABS(slope[g]));
    }
    if (largest > FB_R(0.0)) {
      fb_strain_row *row = &body->strain_row[body->n_strain_row++];
      fbi_copy(row->slope, slope, FBI_MAX_STRAINS);
      row->axis = (unsigned short)(i % 3);
      row->a = (unsigned short)(i / 3);
    }
  }
}

/* A += sum of weight_g slope_a slope_b over the transverse rows, n x n */
static void fbi_slope_matrix(fb_real *A, const fb_body *body)
{
  const int n = body->n;
  for (int i = 0; i < body->n_strain_row; i++) {
    for (int j = 0; j < body->n_strain_row; j++) {
      const fb_strain_row *a = &body->strain_row[i], *b = &body->strain_row[j];
      for (int g = 0; g < body->n_strain && a->axis == b->axis && a->axis > 0; g++) {
        A[a->a * n + b->a] += body->strain_weight[g] * a->slope[g] * b->slope[g];
      }
    }
  }
}

/* Largest change of a frequency by centrifugal tension T per squared spin, 1/2 T S / omega with S = int psi' psi' dx:
   half the root of the largest eigenvalue of S M^-1 S against K, times the tension of the beam's own mass. */
static fb_status fbi_tension_fill(fb_body *body, fb_body_work *work, const fb_shape *shape, const fb_real *reduced)
{
  const int n = body->n;
  fb_real largest = FB_R(0.0), size = FB_R(0.0); /* largest element of S, whose squares may overflow */
  fb_status status;
  body->limit_tension = FB_R(0.0);
  if (body->n_strain == 0 || n == 0) {
    return FB_OK;
  }

  /* S, scaled to largest element 1 */
  fbi_zero(work->A, n * n);
  fbi_slope_matrix(work->A, body);
  for (int ab = 0; ab < n * n; ab++) {
    size = fbi_larger(size, FB_FABS(work->A[ab]));
  }
  for (int ab = 0; ab < n * n && size > FB_R(0.0); ab++) {
    work->A[ab] /= size;
  }

  /* S M^-1 S */
  fbi_copy(work->L, reduced, n * n);
  status = fb_chol_factor(work->L, n);
  for (int a = 0; a < n && status == FB_OK; a++) {
    fbi_chol_forward(work->X + a * n, work->L, work->A + a * n, n);
  }
  for (int ab = 0; ab < n * n; ab++) {
    work->A[ab] = fbi_dot(work->X + ab / n * n, work->X + ab % n * n, n);
  }

  /* Against K, made definite */
  fbi_copy(work->L, shape->K, n * n);
  for (int a = 0; a < n; a++) { /* a small part of its own or, without one, of the stiffest */
    const fb_real own = shape->K[a * n + a], other = body->limit_elastic * reduced[a * n + a];
    work->L[a * n + a] += (FB_SINGLE ? FB_R(1e-6) : FB_R(1e-9)) * (own > FB_R(0.0) ? own : other);
  }
  status = status == FB_OK ? fbi_largest_eigenvalue(&largest, work, work->L, n) : status;
  body->limit_tension = FB_R(0.5) * shape->stretch * size * FB_SQRT(largest);
  return status;
}
#endif

/* [E8.8] Bounds of the body's highest frequency |lambda| <= g + sqrt(g^2 + k) with g = |w| + limit_damping / 2,
   k = limit_elastic + limit_spin w^2 + limit_acceleration |a|: the largest eigenvalues of K, C and the stiffening
   against the elastic mass of the free body, M - M_re^T M_rr^-1 M_re. The gyroscopic part is |N(w) q| <= |w| |q|
   against M, a bound for a prescribed base, for a free one confirmed by trials only. At rest the bound is the frequency
   itself.
   Source: quadratic eigenvalue bound |lambda|^2 <= 2 g |lambda| + k.  Fails: M or S_0 not positive definite.
   Test: the_step_limit_is_the_stability_boundary. */
static fb_status fbi_limits_fill(fb_body *body, fb_body_work *work, const fb_shape *shape)
{
  const int n = body->n;
  fb_real *reduced = work->Lambda; /* free until Lambda is filled */
  fb_status status = FB_OK;

  /* Elastic mass of the free body, M - M_re^T M_rr^-1 M_re */
  fbi_copy(reduced, shape->M, n * n);
  {
    fb_real S[21];
    fbi_rigid_matrix(S, shape->mass, shape->c, shape->J);
    for (int b = 0; b < n && status == FB_OK; b++) {
      fb_real column[6];
      fbi_copy(column, shape->P + 3 * b, 3);
      fbi_copy(column + 3, shape->H + 3 * b, 3);
      status = fbi_base_solve(column, body->base, S, column);
      for (int a = 0; a < n; a++) {
        reduced[a * n + b] -= fb_vec3_dot(column, shape->P + 3 * a) + fb_vec3_dot(column + 3, shape->H + 3 * a);
      }
    }
  }

  /* Stiffness */
  fbi_copy(work->A, shape->K, n * n);
  status = status == FB_OK ? fbi_largest_eigenvalue(&body->limit_elastic, work, reduced, n) : status;
#if FB_WITH_NONLINEAR_STRAIN
  fbi_zero(work->A, n * n);
  fbi_slope_matrix(work->A, body);
  status = status == FB_OK ? fbi_largest_eigenvalue(&body->limit_slope, work, reduced, n) : status;
  status = status == FB_OK ? fbi_tension_fill(body, work, shape, reduced) : status;
#endif

  /* Damping and geometric stiffening, where they are on */
  body->limit_damping = FB_R(0.0);
  body->limit_spin = FB_R(0.0);
  body->limit_acceleration = FB_R(0.0);
#if FB_WITH_DAMPING
  fbi_sparse_to_dense(work->A, &body->C, n);
  status = status == FB_OK ? fbi_largest_eigenvalue(&body->limit_damping, work, reduced, n) : status;
#endif
#if FB_WITH_SPIN_STIFFENING
  if (fbi_has(body->effects, FB_EFFECT_SPIN_STIFFENING)) {
    status = status == FB_OK ? fbi_table_norm(&body->limit_spin, work, shape->Gamchi, 9, reduced, n) : status;
  }
#endif
#if FB_WITH_ACCELERATION_STIFFENING
  if (fbi_has(body->effects, FB_EFFECT_ACCELERATION_STIFFENING)) {
    status = status == FB_OK ? fbi_table_norm(&body->limit_acceleration, work, shape->pchi, 3, reduced, n) : status;
  }
#endif
  return status;
}

/* Is A the unit matrix to round-off? */
static int fbi_is_unit(const fb_sparse *A, int n)
{
  for (int a = 0; a < n; a++) {
    if (FB_FABS(A->diagonal[a] - FB_R(1.0)) > FBI_ROUNDING) {
      return 0;
    }
  }
  return A->n_term == 0;
}

/* Base mobility `recoil`: the root of the largest eigenvalue of M_rr x = lambda S_0 x over the rows that the base
   leaves free; radius of gyration about O. */
static fb_status fbi_recoil_fill(fb_body *body, const fb_shape *shape)
{
  const int first = fbi_first_free(body->base), rows = 6 - first;
  fb_real M_rr[21], A[36], B[36], X[36], d[6];
  fb_status status = FB_OK;
  body->recoil = FB_R(1.0);
  body->gyration = shape->mass > FB_R(0.0)
                       ? FB_SQRT((shape->J[0] + shape->J[4] + shape->J[8]) / (FB_R(2.0) * shape->mass))
                       : FB_R(0.0);

  /* Free rows of both matrices */
  fbi_rigid_matrix(M_rr, shape->mass, shape->c, shape->J);
  for (int i = 0; i < rows * rows; i++) {
    const int at = fb_sym6_index(first + i / rows, first + i % rows);
    A[i] = M_rr[at];
    B[i] = body->S0[at];
  }
  if (rows > 0) {
    status = fb_eig_gen_solve(d, X, A, B, rows);
    body->recoil = FB_SQRT(status == FB_OK ? d[rows - 1] : FB_R(1.0));
  }
  return status;
}

/* M^-1 and S_0^-1. */
static fb_status fbi_inverses_fill(fb_body *body, fb_body_work *work)
{
  const int n = body->n;
  fb_real reference[6];

  /* M^-1; work.L holds the factor of M */
  for (int j = 0; j < n; j++) {
    fbi_zero(work->d, n);
    work->d[j] = FB_R(1.0);
    fb_chol_solve(work->A + j * n, work->L, work->d, n);
  }
  fbi_sparse_fill(&body->Minv, work->A, n);

  /* S_0^-1 over the free rows, if S_0 is not singular to round-off */
  fbi_sym6_reference(reference, body->S0, FB_R(0.0), FB_R(0.0));
  if (!fbi_sym6_stands_out(body->S0, fbi_first_free(body->base), reference, FBI_ROUNDING)) {
    return FB_ERR_SINGULAR;
  }
  for (int j = 0; j < 6; j++) {
    fb_real unit[6] = {0};
    unit[j] = FB_R(1.0);
    if (fbi_base_solve(body->S0_inverse + 6 * j, body->base, body->S0, unit) != FB_OK) {
      return FB_ERR_SINGULAR;
    }
  }
  return FB_OK;
}

/* Do the equations depend on where in the body O lies? A free origin accelerates, which spin stiffening without
   acceleration stiffening ignores. */
static int fbi_depends_on_origin(unsigned effects, fb_base base)
{
  return base == FB_BASE_FREE && fbi_has(effects, FB_EFFECT_SPIN_STIFFENING) &&
         !fbi_has(effects, FB_EFFECT_ACCELERATION_STIFFENING);
}

#if FB_WITH_FORMS
/* Effects that a form needs or excludes: the second-order form with its configuration-dependent mass matrix needs
   J(q) and h(q) together (ERRATA.md DBe); the printed first-order form has no quadratic field, and its printed torque
   belongs to one kind of basis. */
static fb_status fbi_form_check(const fb_shape *shape, const fb_body_desc *desc)
{
  const int spin = fbi_has(desc->effects, FB_EFFECT_SPIN_COUPLING);
  if (!fbi_is_choice((int)desc->form, (int)FB_FORM_COUNT - 1) ||
      !fbi_is_choice((int)desc->stiffness_torque, (int)FB_TORQUE_COUNT - 1)) {
    return FB_ERR_VALUE;
  }

  /* Effects */
  if (desc->form == FB_FORM_SECOND && !desc->allow_split_effects &&
      spin != fbi_has(desc->effects, FB_EFFECT_RESIDUAL_INERTIA)) {
    return FB_ERR_EFFECTS;
  }
  if (desc->form == FB_FORM_FIRST && fbi_has(desc->effects, FBI_QUADRATIC_EFFECTS)) {
    return FB_ERR_EFFECTS;
  }
#if FB_WITH_NONLINEAR_STRAIN
  if (desc->form == FB_FORM_FIRST && desc->stiffness_torque != FB_TORQUE_IDENTITY &&
      (shape->n_strain == 0 || shape->torque_unknown)) {
    return FB_ERR_EFFECTS;
  }
#else
  if (desc->stiffness_torque != FB_TORQUE_IDENTITY) {
    return FB_ERR_EFFECTS;
  }
#endif
  (void)shape;
  return FB_OK;
}
#endif

/* Counts within the tables and all values finite: the caller may write into a shape. */
static fb_status fbi_shape_check(const fb_shape *shape)
{
  const int n = shape->n >= 0 && shape->n <= FB_MAX_MODES ? shape->n : 0, nn = n * n;
  const fbi_number table[] = {
    FBI_ANY(&shape->mass, 1, "shape.mass [kg]"),
    FBI_ANY(&shape->size, 1, "shape.size [m]"),
    FBI_ANY(shape->c, 3, "shape.c [kg m]"),
    FBI_ANY(shape->J, 9, "shape.J [kg m^2]"),
    FBI_ANY(shape->P, 3 * n, "shape.P"),
    FBI_ANY(shape->H, 3 * n, "shape.H"),
    FBI_ANY(shape->M, nn, "shape.M"),
    FBI_ANY(shape->K, nn, "shape.K"),
    FBI_ANY(shape->reach, n, "shape.reach"),
#if FB_WITH_SPIN_COUPLING
    FBI_ANY(shape->ups, 3 * nn, "shape.ups"),
#endif
#if FB_WITH_RESIDUAL_INERTIA
    FBI_ANY(shape->Gam, 9 * n, "shape.Gam"),
    FBI_ANY(shape->Pi, 9 * nn, "shape.Pi"),
#endif
#if FB_WITH_SPIN_STIFFENING
    FBI_ANY(shape->Gamchi, 9 * nn, "shape.Gamchi"),
#endif
#if FB_WITH_ACCELERATION_STIFFENING
    FBI_ANY(shape->pchi, 3 * nn, "shape.pchi"),
    FBI_ANY(shape->hchi, 3 * nn, "shape.hchi"),
#endif
#if FB_WITH_NONLINEAR_STRAIN
    FBI_ANY(&shape->stretch, 1, "shape.stretch"),
    FBI_ANY(shape->strain_weight, shape->n_strain, "shape.strain_weight"),
#if FB_WITH_FORMS
    FBI_ANY(shape->torque, 3 * nn, "shape.torque"),
    FBI_ANY(shape->torque_boundary, 3 * nn, "shape.torque_boundary"),
#endif
#endif
  };
  fb_status status;
  FBI_REQUIRE(shape->n == n && shape->n_node >= 1 && shape->n_node <= FB_MAX_NODES, FB_ERR_CAPACITY);
#if FB_WITH_NONLINEAR_STRAIN
  FBI_REQUIRE(shape->n_strain >= 0 && shape->n_strain <= FBI_MAX_STRAINS && shape->n_strain % 4 == 0, FB_ERR_CAPACITY);
#endif

  /* Finite values, table by table */
  status = fbi_numbers_check(table, FBI_LENGTH(table), -1);
#if FB_WITH_NONLINEAR_STRAIN
  for (int k = 0; k < 3 * n && status == FB_OK; k++) {
    const fbi_number slope[] = {FBI_ANY(shape->slope + k * FBI_MAX_STRAINS, shape->n_strain, "mode: shape.slope")};
    status = fbi_numbers_check(slope, 1, k / 3);
  }
#endif
  for (int k = 0; k < shape->n_node && status == FB_OK; k++) {
    if (!fbi_node_is_finite(&shape->node[k], n)) {
      status = FBI_REFUSE(FB_ERR_NOT_FINITE, "node: place and shapes, finite", k, FB_R(0.0), FB_R(0.0));
    }
  }
  return status;
}

/* Effects: no value without its effect, none excluded by the build, none without its partner. */
static fb_status fbi_body_effects_check(const fb_shape *shape, const fb_body_desc *desc)
{
  if (!fbi_has(desc->effects, FB_EFFECT_DAMPING) && !fbi_is_zero(desc->zeta, shape->n)) {
    return FBI_REFUSE(FB_ERR_EFFECTS, "zeta, 0 without FB_EFFECT_DAMPING", -1, FB_R(0.0), FB_R(0.0));
  }
  if (!fbi_has(desc->effects, FB_EFFECT_GRAVITY) && !fbi_is_zero(desc->gravity, 3)) {
    return FBI_REFUSE(FB_ERR_EFFECTS, "gravity [m/s^2], 0 without FB_EFFECT_GRAVITY", -1, FB_R(0.0), FB_R(0.0));
  }
  if (fbi_is_excluded(desc->effects)) {
    return FBI_REFUSE(FB_ERR_EFFECTS, FBI_WORD_EXCLUDED, -1, FB_R(0.0), FB_R(0.0));
  }
  if (!desc->allow_split_effects) {
    const int whole = fb_effects_check(desc->effects) == FB_OK; /* with a record of its own */
    if (!whole) {
      return FB_ERR_EFFECTS;
    }
    if (fbi_depends_on_origin(desc->effects, desc->base)) {
      return FBI_REFUSE(FB_ERR_EFFECTS, "effects: spin stiffening of a free body, with acceleration stiffening", -1,
                        FB_R(0.0), FB_R(0.0));
    }
    if (desc->truncation != FB_TRUNCATE_NONE) {
      return FBI_REFUSE(FB_ERR_EFFECTS, "truncation, with allow_split_effects only", -1, FB_R(0.0), FB_R(0.0));
    }
  }
#if FB_WITH_NONLINEAR_STRAIN
  if (fbi_has(desc->effects, FB_EFFECT_NONLINEAR_STRAIN) && shape->n_strain == 0) {
    return FBI_REFUSE(FB_ERR_EFFECTS, "effects: nonlinear strain, with fb_shape_add_beam_strain", -1, FB_R(0.0),
                      FB_R(0.0));
  }
#endif
#if FB_WITH_FORMS
  return fbi_form_check(shape, desc);
#else
  return FB_OK;
#endif
}

static fb_status fbi_body_desc_check(const fb_shape *shape, const fb_body_desc *desc)
{
  const fbi_number field[] = {FBI_ANY(desc->zeta, shape->n, "zeta"), FBI_ANY(desc->gravity, 3, "gravity [m/s^2]"),
                              FBI_NOT_NEGATIVE(&desc->deflection_limit, 1, "deflection_limit [m]")};
  const fbi_count count[] = {
      FBI_COUNT((int)desc->base, 0, (int)FB_BASE_COUNT - 1, "base, an fb_base, beyond"),
      FBI_COUNT((int)desc->truncation, 0, (int)FB_TRUNCATE_COUNT - 1, "truncation, an fb_truncation, beyond")};
  fb_status status = fbi_shape_check(shape);
  status = status ? status : fbi_numbers_check(field, FBI_LENGTH(field), -1);
  status = status ? status : fbi_counts_check(FB_ERR_VALUE, count, FBI_LENGTH(count), -1);
  for (int k = 0; k < shape->n && status == FB_OK; k++) {
    const fbi_number mode[] = {FBI_NOT_NEGATIVE(&desc->zeta[k], 1, "mode: damping ratio zeta"),
                               FBI_NOT_NEGATIVE(&shape->K[k * shape->n + k], 1, "mode: stiffness shape.K (buckled)")};
    status = fbi_numbers_check(mode, FBI_LENGTH(mode), k);
  }
  if (status == FB_OK && !(shape->mass > FB_R(0.0) || (shape->mass == FB_R(0.0) && desc->base == FB_BASE_PRESCRIBED))) {
    return FBI_REFUSE(FB_ERR_VALUE, "mass [kg] (of a prescribed base at least) above", -1, shape->mass, FB_R(0.0));
  }
  return status ? status : fbi_body_effects_check(shape, desc);
}

/* Copies a node for n coordinates. */
static void fbi_node_copy(fb_node *to, const fb_node *from, int n)
{
  fbi_copy(to->r, from->r, 3);
  fbi_copy(to->psi, from->psi, 3 * n);
  fbi_copy(to->theta, from->theta, 3 * n);
#if FBI_WITH_QUADRATIC
  fbi_copy(to->chi, from->chi, 3 * n * (n + 1) / 2);
  fbi_copy(to->chi_theta, from->chi_theta, 3 * n * (n + 1) / 2);
#endif
}

/* Fills a body but for damping, limits, inverses and the terms of Lambda and S. */
static void fbi_body_fill(fb_body *body, const fb_shape *shape, const fb_body_desc *desc)
{
  memset(body, 0, sizeof *body);

  /* Effects and form */
  body->effects = desc->effects & FB_EFFECT_ELASTIC ? desc->effects : desc->effects & FB_EFFECT_GRAVITY;
  if (desc->truncation == FB_TRUNCATE_ABOVE_0) {
    body->effects &= ~(unsigned)FB_EFFECT_NONLINEAR_STRAIN;
  }
#if FB_WITH_FORMS
  body->form = desc->form;
  body->stiffness_torque = desc->stiffness_torque;
  body->torque_degree = desc->truncation == FB_TRUNCATE_NONE ? 3 : (int)desc->truncation - 1;
  if (desc->form == FB_FORM_FIRST) {
    body->effects &= ~(unsigned)FB_EFFECT_RESIDUAL_INERTIA;
  }
#endif

  /* Sizes and options */
  body->n = desc->effects & FB_EFFECT_ELASTIC ? shape->n : 0;
  body->n_node = shape->n_node;
  body->base = desc->base;
  body->allow_long_step = desc->allow_long_step != 0;

  /* M and K, and what follows from them */
  fbi_sparse_fill(&body->M, shape->M, body->n);
  fbi_sparse_fill(&body->K, shape->K, body->n);
  body->unit_mass = fbi_is_unit(&body->M, body->n);
  body->constant_S = body->n == 0 || !fbi_has(body->effects, FB_EFFECT_RESIDUAL_INERTIA | FBI_QUADRATIC_EFFECTS);

  /* Rigid body, deflection limit, nodes */
  body->mass = shape->mass;
  fbi_copy(body->c, shape->c, 3);
  body->deflection_limit = desc->deflection_limit > FB_R(0.0) ? desc->deflection_limit : FB_R(0.5) * shape->size;
  fbi_copy(body->reach, shape->reach, body->n);
#if FB_WITH_GRAVITY
  if (fbi_has(body->effects, FB_EFFECT_GRAVITY)) {
    fbi_copy(body->gravity, desc->gravity, 3);
  }
#endif
#if FB_WITH_NONLINEAR_STRAIN
  fbi_strain_fill(body, shape, desc->truncation);
#endif
  for (int k = 0; k < shape->n_node; k++) {
    fbi_node_copy(&body->node[k], &shape->node[k], body->n);
  }
}

#if FB_WITH_FORMS
/* Appends the elements of a table (n x m, element i of coordinate or pair k at table[m k + i]) that are not
   round-off, times c. */
static void fbi_table_list(fb_lambda_term *list, int *n_list, const fb_real *table, int m, int n, int bilinear,
                           fb_real c)
{
  fb_real largest = FB_R(0.0);
  const int count = bilinear ? n * n : n;
  for (int k = 0; k < m * count; k++) {
    largest = fbi_larger(largest, FB_FABS(table[k]));
  }
  for (int k = 0; k < m * count; k++) {
    if (FB_FABS(table[k]) > FBI_ROUNDING * largest) {
      fb_lambda_term *term = &list[(*n_list)++];
      term->c = c * table[k];
      term->i = (unsigned short)(k % m);
      term->a = (unsigned short)(bilinear ? k / m / n + 1 : k / m + 1);
      term->b = (unsigned short)(bilinear ? k / m % n : 0);
    }
  }
}

/* Tables of the form: S(q), or M_rr(q) in its place for the second-order form, with the terms that truncation leaves.
   Rates and gradients keep one degree more than values: Gamma^(Q) belongs to J^(Q+1). */
static void fbi_form_fill(fb_body *body, fb_body_work *work, const fb_shape *shape)
{
  const int n = body->n;
  int linear;

  /* S(q), or with Lambda = 0 M_rr(q) */
  fbi_rigid_matrix(body->M_rr, shape->mass, shape->c, shape->J);
  if (body->form == FB_FORM_SECOND) {
    fbi_zero(work->Lambda, (n + 1) * 6 * n);
  }
  linear = fbi_S_list(body, work, shape);

  /* Number of terms that the values keep */
  body->n_run_value = body->n_run;
  body->n_lambda_value = body->form == FB_FORM_FIRST ? body->n_lambda_constant : body->n_lambda;
  if (body->form == FB_FORM_SECOND && body->torque_degree < 2) {
    body->n_run_value = body->torque_degree == 0 ? 0 : linear;
    body->n_run = body->torque_degree == 0 ? linear : body->n_run;
    body->n_lambda_value = body->torque_degree == 0 ? body->n_lambda_constant : body->n_lambda;
  }

  /* First-order form: Gam_a and the printed stiffness torque */
  body->n_gam = body->n_torque = 0;
  if (body->form != FB_FORM_FIRST) {
    return;
  }
  fbi_table_list(body->gam, &body->n_gam, shape->Gam, 9, n, 0, FB_R(1.0));
#if FB_WITH_NONLINEAR_STRAIN
  if (body->stiffness_torque != FB_TORQUE_IDENTITY && body->torque_degree > 0) {
    fb_real *table = work->Lambda; /* free by now */
    for (int k = 0; k < 3 * n * n; k++) {
      const fb_real boundary = body->stiffness_torque == FB_TORQUE_BOUNDARY ? shape->torque_boundary[k] : FB_R(0.0);
      table[k] = shape->torque[k] + boundary;
    }
    fbi_table_list(body->torque, &body->n_torque, table, 3, n, 1, FB_R(1.0));
  }
#endif
}
#endif

/* Terms of Lambda(q) and S(q) for the effects that are on. Without residual inertia ups is in Lambda, not in S. */
static fb_status fbi_terms_fill(fb_body *body, fb_body_work *work, const fb_shape *shape)
{
  const int n = body->n;
  const int ups = fbi_has(body->effects, FB_EFFECT_SPIN_COUPLING);
  const int chi = fbi_has(body->effects, FB_EFFECT_ACCELERATION_STIFFENING);
  fb_status status = FB_OK;

  /* Lambda */
  fbi_lambda_fill(work->Lambda, shape, n, ups, chi);
  fbi_lambda_list(body, shape, work->Lambda);
  if (body->n_lambda > FBI_MAX_LAMBDA) {
    return FB_ERR_CAPACITY;
  }

  /* S from Z = Lambda L^-T, row by row, M = L L^T */
  fbi_lambda_fill(work->Lambda, shape, n, ups && fbi_has(body->effects, FB_EFFECT_RESIDUAL_INERTIA), chi);
  fbi_copy(work->L, shape->M, n * n);
  if (n > 0) {
    status = fb_chol_factor(work->L, n);
  }
  if (status != FB_OK) {
    return status;
  }
  for (int row = 0; row < (n + 1) * 6; row++) {
    fbi_chol_forward(work->Lambda + row * n, work->L, work->Lambda + row * n, n);
  }
#if FB_WITH_FORMS
  fbi_form_fill(body, work, shape);
#else
  (void)fbi_S_list(body, work, shape);
#endif
  return body->n_S > FBI_MAX_S || body->n_run > FBI_MAX_RUNS ? FB_ERR_CAPACITY : FB_OK;
}

FB_DEF fb_status fb_body_init(fb_body *body, fb_body_work *work, const fb_shape *shape, const fb_body_desc *desc)
{
  fb_body *out;
  fb_status status;
  FBI_REQUIRE(body && work && shape && desc, FB_ERR_NULL);
  FBI_REQUIRE_EXACT();
  status = fbi_body_desc_check(shape, desc);
  if (status != FB_OK) {
    return status;
  }
  out = &work->body;
  fbi_body_fill(out, shape, desc);
#if FB_WITH_DAMPING
  status = fbi_damping_fill(out, work, shape, desc->zeta);
#endif
  status = status == FB_OK ? fbi_limits_fill(out, work, shape) : status;
  status = status == FB_OK ? fbi_terms_fill(out, work, shape) : status;
  status = status == FB_OK ? fbi_inverses_fill(out, work) : status;
  status = status == FB_OK ? fbi_recoil_fill(out, shape) : status;
  if (status == FB_OK) {
    *body = *out;
  }
  return status;
}

/* The description of a beam as part of a body: its own position and attitude follow those of the part. */
static fb_status fbi_part_place(fb_beam_desc *placed, const fb_part *part, const fb_beam_desc *beam)
{
  fb_real frame[4], own[4], R[9], offset[3];
  fb_status status;
  const fbi_number field[] = {FBI_ANY(part->attitude, 4, "attitude of the part"),
                              FBI_ANY(beam->attitude, 4, "attitude of the beam")};
  status = fbi_numbers_check(field, FBI_LENGTH(field), -1);
  status = status ? status : fbi_quat_from_attitude(frame, part->attitude);
  status = status ? status : fbi_quat_from_attitude(own, beam->attitude);
  if (status != FB_OK) {
    return status;
  }
  *placed = *beam;
  fb_quat_mul(placed->attitude, frame, own);
  fb_quat_to_mat33(R, frame);
  fb_mat33_mul_vec3(offset, R, beam->position);
  fbi_vec3_copy(placed->position, part->position);
  fbi_vec3_add(placed->position, FB_R(1.0), offset);
  return FB_OK;
}

/* Is part k attached, and once? A clamped root is fixed to the frame: a weld there would only lock the other part. A
   pinned root is attached to the frame, a free one by a weld; natural modes need their rigid-body modes to follow what
   they are attached to. A part that is the whole body moves with the frame. */
static int fbi_part_fits(const fb_build_desc *desc, const fb_modes_desc *modes, fb_root root, int k, int alone)
{
  const int moves = modes->basis != FB_BASIS_MODES || modes->rigid;
  int welds = 0, at_root = 0;
  for (int w = 0; w < 2 * desc->join.n_weld; w++) {
    const fb_weld *const weld = &desc->join.weld[w / 2];
    if (weld->component[w % 2] == k) {
      welds++;
      at_root += weld->node[w % 2] == 0;
    }
  }
  return root == FB_ROOT_CLAMPED ? at_root == 0 : alone || (moves && (welds > 0 || root == FB_ROOT_PINNED));
}

/* What is wrong with a part that does not fit, by its root. */
#define FBI_ROOT_WORD(root)                                                                         \
  ((root) == FB_ROOT_CLAMPED  ? "part: clamped root with a weld there, although fixed to the frame" \
   : (root) == FB_ROOT_PINNED ? "part: pinned root, natural modes without rigid"                    \
                              : "part: free root without a weld, or natural modes without rigid")

/* The beam of each part and its modes, common ones where parts are joined; work->n: how many coordinates they make. */
static fb_status fbi_parts_solve(fb_build_work *work, const fb_build_desc *desc, const fb_beam_desc *beam,
                                 const fb_modes_desc *modes, int n_beam)
{
  const fb_join_desc *const join = &desc->join;
  const int joined = join->n_weld != 0 || join->lowest != 0 || !fbi_is_zero(&join->omega_limit, 1);
  fb_status status = FB_OK;
  work->n = 0;
  for (int k = 0; k < desc->n_part && status == FB_OK; k++) {
    const fb_part *const part = &desc->part[k];
    work->part = k;
    FBI_REQUIRE(part->beam >= 0 && part->beam < n_beam, FB_ERR_CAPACITY);
    FBI_REQUIRE(part->n_node >= 0 && part->n_node <= FB_MAX_NODES, FB_ERR_CAPACITY);
    status = fbi_part_place(&work->placed, part, &beam[part->beam]);
    status = status ? status : fb_beam_init(&work->beam[k], &work->placed);
    status =
        status ? status : fb_modes_solve(&work->modes[k], &work->scratch.modes, &work->beam[k], &modes[part->beam]);
    work->n += status == FB_OK ? work->modes[k].n : 0;
    status = status == FB_OK && work->n > FB_MAX_MODES && !joined ? FB_ERR_CAPACITY : status;
  }
  if (status == FB_OK && joined) {
    work->part = desc->n_part;
    status = fb_modes_join(work->modes, &work->scratch.join, work->beam, work->modes, join, desc->n_part);
    work->n = status == FB_OK ? work->modes[0].n : 0;
  }
  return status;
}

/* The first part that is not attached as fbi_part_fits wants it; -1: none. */
static int fbi_part_at_fault(const fb_build_work *work, const fb_build_desc *desc, const fb_modes_desc *modes, int hub)
{
  const int alone = desc->n_part == 1 && !hub;
  for (int k = 0; k < desc->n_part; k++) {
    if (!fbi_part_fits(desc, &modes[desc->part[k].beam], work->beam[k].desc.root, k, alone)) {
      return k;
    }
  }
  return -1;
}

/* One beam of the body, its coordinates from `first` on: its integrals, and its nodes as the next nodes. */
static fb_status fbi_part_add(fb_shape *shape, const fb_part *part, int first, const fb_beam *beam,
                              const fb_modes *modes, unsigned effects)
{
  int node;
  fb_status status = fb_shape_add_beam(shape, first, beam, modes);
  for (int k = 0; k < part->n_node && status == FB_OK; k++) {
    status = fb_shape_add_beam_node(shape, &node, first, beam, modes, part->node[k]);
  }
#if FB_WITH_NONLINEAR_STRAIN
  if (status == FB_OK && fbi_has(effects, FB_EFFECT_NONLINEAR_STRAIN)) {
    status = fb_shape_add_beam_strain(shape, first, beam, modes);
  }
#else
  (void)effects;
#endif
  return status;
}

FB_DEF fb_status fb_body_build(fb_body *body, fb_build_work *work, const fb_build_desc *desc, const fb_beam_desc *beam,
                               const fb_modes_desc *modes, int n_beam)
{
  int first = 0, hub, fault;
  fb_status status;
  FBI_REQUIRE(body && work && desc && ((beam && modes) || n_beam == 0), FB_ERR_NULL);
  FBI_REQUIRE(desc->n_part >= 0 && desc->n_part <= FB_MAX_PARTS, FB_ERR_CAPACITY);

  /* beams, and the coordinates that there are */
  hub = !fbi_is_zero(&desc->mass, 1) || !fbi_is_zero(desc->inertia, 6);
  status = fbi_parts_solve(work, desc, beam, modes, n_beam);
  fault = status == FB_OK ? fbi_part_at_fault(work, desc, modes, hub) : -1;
  if (fault >= 0) {
    work->part = fault;
    status = FBI_REFUSE(FB_ERR_VALUE, FBI_ROOT_WORD(work->beam[fault].desc.root), fault, FB_R(0.0), FB_R(0.0));
  }
  if (status != FB_OK) {
    FBI_DETAIL_PART(work->part);
    return status;
  }

  /* hub and parts */
  work->part = -1;
  status = fb_shape_init(&work->shape, work->n);
  if (hub) {
    status = status ? status : fb_shape_add_rigid(&work->shape, desc->mass, desc->center, desc->inertia);
  }
  for (int k = 0; k < desc->n_part && status == FB_OK; k++) {
    const fb_modes *const basis = &work->modes[k];
    work->part = k;
    status = fbi_part_add(&work->shape, &desc->part[k], first, &work->beam[k], basis, desc->body.effects);
    first += basis->joined ? 0 : basis->n;
  }
  if (status != FB_OK) {
    FBI_DETAIL_PART(work->part);
    return status;
  }

  /* one damping ratio for all */
  work->part = desc->n_part;
  work->desc = desc->body;
  if (status == FB_OK && !fbi_is_zero(&desc->zeta, 1)) {
    status = fbi_is_zero(desc->body.zeta, work->n)
                 ? FB_OK
                 : FBI_REFUSE(FB_ERR_VALUE, "zeta for all modes, not with body.zeta", -1, desc->zeta, FB_R(0.0));
    for (int k = 0; k < work->n; k++) {
      work->desc.zeta[k] = desc->zeta;
    }
  }
  return status ? status : fb_body_init(body, &work->scratch.body, &work->shape, &work->desc);
}

#if FB_WITH_SYSTEM
/* ---- joints of systems */

/* Unit twists of the axes of a joint, six numbers each, in joint.A. */
static void fbi_joint_twists(fb_joint *joint)
{
  static const fb_real unit[3][3] = {
      {FB_R(1.0), FB_R(0.0), FB_R(0.0)}, {FB_R(0.0), FB_R(1.0), FB_R(0.0)}, {FB_R(0.0), FB_R(0.0), FB_R(1.0)}};
  const fbi_joint_traits *is = fbi_traits(joint);
  for (int i = 0; i < is->n_axis && joint->kind != FB_JOINT_FREE; i++) {
    const fb_real *axis = unit[fbi_is_ball(joint->kind) ? i : i == is->tilt ? 0 : 2];
    if (i == is->slide) {
      fbi_axis_twist(joint->A + 6 * i, joint, axis, FB_R(0.0), FB_R(1.0));
    } else {
      fbi_axis_twist(joint->A + 6 * i, joint, axis, FB_R(1.0), is->pitched ? joint->pitch : FB_R(0.0));
    }
  }
}

/* Rotation matrix of a quaternion of a desc; all zeros mean identity. */
static void fbi_attitude_axes(fb_real R[9], const fb_real quat[4])
{
  const fb_real identity[4] = {FB_R(1.0), FB_R(0.0), FB_R(0.0), FB_R(0.0)};
  fb_quat_to_mat33(R, fbi_vec3_norm(quat + 1) == FB_R(0.0) ? identity : quat);
}

/* Axes of a joint whose z axis lies along `axis`: the smallest rotation of z onto it, by atan2(|z x axis|, z . axis)
   about z x axis; about x where it is -z. */
static void fbi_axis_frame(fb_real R[9], const fb_real axis[3])
{
  const fb_real across = FB_SQRT(axis[0] * axis[0] + axis[1] * axis[1]), angle = FB_ATAN2(across, axis[2]);
  fb_real phi[3] = {angle, FB_R(0.0), FB_R(0.0)}, quat[4];
  if (across > FB_R(0.0)) {
    phi[0] = -angle * (axis[1] / across);
    phi[1] = angle * (axis[0] / across);
  }
  fb_quat_from_rotvec(quat, phi);
  fb_quat_to_mat33(R, quat);
}

/* A side of a joint has an axis, which is one, or an attitude, or neither. */
static int fbi_is_side(const fb_real axis[3], const fb_real attitude[4])
{
  return fbi_is_zero(axis, 3) || (fbi_is_zero(attitude, 4) && fbi_vec3_norm(axis) > FB_TINY);
}

/* Checks joint j of a desc: those from n_body on close loops. */
static fb_status fbi_joint_check(const fb_system_desc *desc, const fb_body *body, int j)
{
  const int loop = j >= desc->n_body, last = loop ? desc->n_body : j;
  const fb_joint_desc *d = loop ? &desc->loop[j - desc->n_body] : &desc->joint[j];
  const int kind = (int)d->kind, free = d->kind == FB_JOINT_FREE,
            bare = fbi_is_zero(d->stiffness, 3) && fbi_is_zero(d->damping, 3);
  const fbi_number field[] = {FBI_ANY(d->position, 3, "joint: position [m]"),
                              FBI_ANY(d->child_position, 3, "joint: child_position [m]"),
                              FBI_ANY(&d->pitch, 1, "joint: pitch [m/rad]"),
                              FBI_NOT_NEGATIVE(d->stiffness, 3, "joint: stiffness [N m/rad, N/m]"),
                              FBI_ANY(d->rest, 3, "joint: rest [rad, m]"),
                              FBI_NOT_NEGATIVE(d->damping, 3, "joint: damping [N m s/rad, N s/m]"),
                              FBI_ANY(d->attitude, 4, "joint: attitude"),
                              FBI_ANY(d->child_attitude, 4, "joint: child_attitude"),
                              FBI_ANY(d->axis, 3, "joint: axis"),
                              FBI_ANY(d->child_axis, 3, "joint: child_axis")};
  const fbi_count choice[] = {FBI_COUNT(kind, 0, (int)FB_JOINT_COUNT - 1, "joint: kind, an fb_joint_kind, beyond"),
                              FBI_COUNT((int)d->mode[0], 0, (int)FB_AXIS_COUNT - 1, "joint: mode[0], beyond"),
                              FBI_COUNT((int)d->mode[1], 0, (int)FB_AXIS_COUNT - 1, "joint: mode[1], beyond"),
                              FBI_COUNT((int)d->mode[2], 0, (int)FB_AXIS_COUNT - 1, "joint: mode[2], beyond")};
  const fbi_claim claim[] = {
      FBI_CLAIM(fbi_is_attitude(d->attitude), "joint: attitude, a quaternion, or all zero"),
      FBI_CLAIM(fbi_is_attitude(d->child_attitude), "joint: child_attitude, a quaternion, or all zero"),
      FBI_CLAIM(fbi_is_side(d->axis, d->attitude), "joint: axis, not so short and without attitude"),
      FBI_CLAIM(fbi_is_side(d->child_axis, d->child_attitude),
                "joint: child_axis, not so short and without child_attitude"),
      FBI_CLAIM(!free || !loop, "joint: kind of one that closes a loop, not FB_JOINT_FREE"),
      FBI_CLAIM(!free || bare, "joint: stiffness and damping of FB_JOINT_FREE, 0")};

  /* Parents of a tree come first; nodes are counted where the bodies exist */
  const int tied = !free && d->parent >= FB_GROUND && d->parent < last;
  const int tied_loop = loop && d->child >= 0 && d->child < desc->n_body;
  const int parent_nodes = tied && d->parent >= 0 ? body[desc->model[d->parent]].n_node : 1;
  const fbi_count parent[] = {
      FBI_COUNT(d->parent, FB_GROUND, last - 1, "joint: parent, a body before it or FB_GROUND, beyond"),
      FBI_COUNT(loop ? d->child : 0, 0, desc->n_body - 1, "joint: child, a body, beyond")};
  const fbi_count node[] = {FBI_COUNT(d->parent_node, 0, parent_nodes - 1, "joint: parent_node, beyond"),
                            FBI_COUNT(loop ? d->child_node : 0, 0,
                                      tied_loop ? body[desc->model[d->child]].n_node - 1 : 0,
                                      "joint: child_node, beyond")};
  fb_status status = fbi_numbers_check(field, FBI_LENGTH(field), j);
  status = status ? status : fbi_counts_check(FB_ERR_VALUE, choice, FBI_LENGTH(choice), j);
  status = status ? status : fbi_claims_check(claim, FBI_LENGTH(claim), j);
  if (status != FB_OK || free) {
    return status;
  }
  status = fbi_counts_check(FB_ERR_VALUE, parent, FBI_LENGTH(parent), j);
  if (status == FB_OK && loop && d->child == d->parent) {
    return FBI_REFUSE(FB_ERR_VALUE, "joint: child, not its parent", j, (fb_real)d->child, FB_R(0.0));
  }
  return status ? status : fbi_counts_check(FB_ERR_CAPACITY, node, FBI_LENGTH(node), j);
}

/* The joint's frame on both sides, by its axes where they are given. turned: the one on the child differs from the
   child's own. */
static void fbi_joint_frames(fb_joint *joint, const fb_joint_desc *d)
{
  const int alike = fbi_is_zero(d->child_axis, 3) && fbi_is_zero(d->child_attitude, 4);
  const fb_real *const child_axis = alike ? d->axis : d->child_axis;
  fbi_attitude_axes(joint->axes, d->attitude);
  fbi_attitude_axes(joint->child_axes, d->child_attitude);
  joint->turned = fbi_vec3_norm(d->child_attitude + 1) > FB_R(0.0);
  if (!fbi_is_zero(d->axis, 3)) {
    fbi_axis_frame(joint->axes, d->axis);
  }
  if (!fbi_is_zero(child_axis, 3)) {
    fbi_axis_frame(joint->child_axes, child_axis);
    joint->turned = !fbi_is_zero(child_axis, 2) || child_axis[2] < FB_R(0.0);
  }
}

/* Fills joint j from its desc; those from n_body on close loops. */
static void fbi_joint_fill(fb_joint *joint, const fb_system_desc *desc, const fb_body *body, int j)
{
  const int loop = j >= desc->n_body;
  const fb_joint_desc *d = loop ? &desc->loop[j - desc->n_body] : &desc->joint[j];
  memset(joint, 0, sizeof *joint);

  /* Bodies and nodes that it connects */
  joint->kind = d->kind;
  joint->parent = d->kind == FB_JOINT_FREE ? FB_GROUND : d->parent;
  joint->parent_node = d->kind == FB_JOINT_FREE ? 0 : d->parent_node;
  joint->child = loop ? d->child : j;
  joint->child_node = loop ? d->child_node : 0;
  joint->n_axis = fbi_traits(joint)->n_axis;
  joint->moves = joint->parent >= 0 && fbi_node_moves(&body[desc->model[joint->parent]], joint->parent_node);

  /* Frames on both bodies; a parent's node that no mode moves is part of the position */
  fbi_vec3_copy(joint->position, d->position);
  if (joint->parent >= 0 && !joint->moves) {
    fbi_vec3_add(joint->position, FB_R(1.0), body[desc->model[joint->parent]].node[joint->parent_node].r);
  }
  fbi_vec3_copy(joint->child_position, d->child_position);
  fbi_joint_frames(joint, d);
  joint->pitch = d->pitch;
  fbi_joint_twists(joint);

  /* Axes; spherical and free joints have one value for all */
  for (int i = 0; i < 3; i++) {
    joint->mode[i] = d->mode[i];
    joint->stiffness[i] = d->stiffness[i];
    joint->rest[i] = d->kind == FB_JOINT_SPHERICAL ? FB_R(0.0) : d->rest[i];
    joint->damping[i] = d->damping[i];
  }
  if (fbi_is_ball(d->kind)) {
    for (int i = 1; i < 3; i++) {
      joint->mode[i] = d->mode[0];
      joint->stiffness[i] = d->stiffness[0];
      joint->damping[i] = d->damping[0];
    }
  }
}

/* ---- systems */

typedef enum fbi_coefficient { FBI_STIFFNESS, FBI_DAMPING } fbi_coefficient; /* K or D of modes and joints */

/* Start vector x of the power method: unequal speeds q_dot of the modes and u of the axes of every body. */
static void fbi_power_start(fb_system_work *w, const fb_system *system, const fb_body *body)
{
  for (int k = 0; k < system->n_body; k++) {
    for (int a = 0; a < fbi_model(system, body, k)->n; a++) {
      w->link[k].q_dot[a] = FB_R(1.0) / (fb_real)(1 + (7 * k + 3 * a) % 5);
    }
    for (int i = 0; i < 3; i++) {
      w->link[k].u[i] = FB_R(1.0) / (fb_real)(1 + (5 * k + 2 * i) % 3);
    }
  }
}

/* p = A x of a body's modes and its joint's free axes, A = K or D; size += x^T A x. */
static void fbi_power_multiply(fb_real *size, fbi_link_work *L, const fb_body *body, const fb_joint *joint,
                               fbi_coefficient A)
{
  const fb_real *const axis = A == FBI_STIFFNESS ? joint->stiffness : joint->damping;

  /* Modes */
  fbi_zero(L->pi, body->n);
  if (A == FBI_STIFFNESS) {
    fbi_sparse_eval(L->pi, NULL, FB_R(1.0), &body->K, L->q_dot, body->n);
  } else {
    fbi_damping_add(L->pi, FB_R(1.0), body, L->q_dot);
  }
  *size += fbi_dot(L->pi, L->q_dot, body->n);

  /* Axes; a free joint has neither springs nor dampers */
  for (int i = 0; i < joint->n_axis && i < 3 && joint->kind != FB_JOINT_FREE; i++) {
    L->p[i] = L->mode[i] == FB_AXIS_FREE ? axis[i] * L->u[i] : FB_R(0.0);
    *size += L->p[i] * L->u[i];
  }
}

/* p = A x / sqrt(x^T A x) of the system; 0 and p = A x where x^T A x = 0, else 1. */
static int fbi_power_scaled(fb_system_work *w, const fb_system *system, const fb_body *body, fbi_coefficient A)
{
  fb_real size = FB_R(0.0);
  for (int k = 0; k < system->n_body; k++) {
    fbi_power_multiply(&size, &w->link[k], fbi_model(system, body, k), fbi_link_joint(system, w, k), A);
  }
  if (!(size > FB_R(0.0))) {
    return 0;
  }
  size = FB_R(1.0) / FB_SQRT(size);
  for (int k = 0; k < system->n_body; k++) {
    for (int a = 0; a < fbi_model(system, body, k)->n; a++) {
      w->link[k].pi[a] *= size;
    }
    for (int i = 0; i < 3; i++) {
      w->link[k].p[i] *= size;
    }
  }
  return 1;
}

/* p^T x over modes and free axes. */
static fb_real fbi_power_product(fb_system_work *w, const fb_system *system, const fb_body *body)
{
  fb_real sum = FB_R(0.0);
  for (int k = 0; k < system->n_body; k++) {
    const fbi_link_work *L = &w->link[k];
    sum += fbi_dot(L->pi, L->q_dot, fbi_model(system, body, k)->n);
    for (int i = 0; i < fbi_link_joint(system, w, k)->n_axis && i < 3; i++) {
      sum += L->mode[i] == FB_AXIS_FREE ? L->p[i] * L->u[i] : FB_R(0.0);
    }
  }
  return sum;
}

/* Largest eigenvalue of A x = lambda M x, A the stiffness or damping of modes and joints, undeformed, at joint
   coordinates of zero: 60 steps of the power method, x = M^-1 p with p = A x scaled to x^T A x = 1. The estimate
   p^T M^-1 p approaches lambda from below: + 5 %. Everything else in the right-hand side is zero. */
static fb_status fbi_system_limit(fb_real *limit, fb_system_work *w, const fb_system *system, const fb_body *body,
                                  fbi_coefficient A)
{
  fb_status status = FB_OK;
  *limit = FB_R(0.0);
  fbi_power_start(w, system, body);
  for (int step = 0; step < 60 && status == FB_OK; step++) {
    if (!fbi_power_scaled(w, system, body, A)) {
      *limit = FB_R(0.0);
      break;
    }
    status = fbi_speeds_solve(w, system, body);
    *limit = fbi_power_product(w, system, body);
  }
  *limit *= FB_R(1.05);
  return status;
}

/* Limits by springs and dampers of joints that multipliers enforce (kept): each axis adds its stiffness times the
   mobility along it; the sum is an upper bound. */
static fb_status fbi_kept_limits(fb_system *system, fb_system_work *w, const fb_body *body)
{
  fb_status status = FB_OK;
  for (int j = 0; j < system->n_body + system->n_loop && status == FB_OK; j++) {
    const fb_joint *joint = &system->joint[j];
    for (int i = 0; i < joint->n_axis && i < 3 && fbi_is_kept(system, w, j) && status == FB_OK; i++) {
      fb_real force[3], torque[3], mobility;
      fbi_frames f;
      w->n_row = w->n_end = 0;
      status = fbi_frames_eval(&f, w, system, body, j);
      if (status == FB_OK) {
        /* Mobility: speed along the axis by a unit impulse on it */
        fbi_frames_axis(force, torque, &f, joint, i);
        (void)fbi_row_new(w, &f, j, force, torque, FB_R(0.0)); /* cannot fail: the list is empty */
        fbi_rhs_clear(w, system, body);
        fbi_row_impulse(w, system, body, 0, FB_R(1.0));
        status = fbi_speeds_solve(w, system, body);
        fbi_ends_move(w, system, body);
        mobility = fbi_row_eval(&w->row[0], w);
        system->limit_kept_elastic += joint->stiffness[i] * mobility;
        system->limit_kept_damping += joint->damping[i] * mobility;
      }
    }
  }
  return status;
}

/* Is k the first body with its model? */
static int fbi_is_first(const int *model, int k)
{
  int i = 0;
  while (model[i] != model[k]) {
    i++;
  }
  return i == k;
}

static fb_status fbi_system_desc_check(const fb_body *body, int n_model, const fb_system_desc *desc)
{
  int used = 0;
  FBI_REQUIRE(desc->n_body >= 1 && desc->n_body <= FB_MAX_BODIES, FB_ERR_CAPACITY);
  FBI_REQUIRE(desc->n_loop >= 0 && desc->n_loop <= FB_MAX_LOOPS, FB_ERR_CAPACITY);
  if (!fbi_is_choice((int)desc->method, (int)FB_METHOD_COUNT - 1)) {
    return FBI_REFUSE(FB_ERR_VALUE, "method, an fb_method, beyond", -1, (fb_real)(int)desc->method,
                      (fb_real)(int)FB_METHOD_COUNT - 1);
  }
  for (int k = 0; k < desc->n_body; k++) {
    FBI_REQUIRE(desc->model[k] >= 0 && desc->model[k] < n_model, FB_ERR_CAPACITY);
    used += fbi_is_first(desc->model, k);
    if (fbi_form(&body[desc->model[k]]) != 0 || fbi_holds_origin(body[desc->model[k]].base)) {
      return FBI_REFUSE(FB_ERR_VALUE, "body: its model, momentum form and neither pinned nor hinged", k, FB_R(0.0),
                        FB_R(0.0));
    }
  }
  /* an unused model though there are bodies enough: desc->model was forgotten */
  return n_model != desc->n_body || used == n_model
             ? FB_OK
             : FBI_REFUSE(FB_ERR_VALUE, "count of models that desc.model names, of as many as bodies, equal to", -1,
                          (fb_real)used, (fb_real)n_model);
}

/* Is the joint at the root of body k's tree free? */
static int fbi_tree_is_free(const fb_system *system, int k)
{
  int root = k;
  for (int i = 0; i < FB_MAX_BODIES && root >= 0 && system->joint[root].parent >= 0; i++) {
    root = system->joint[root].parent;
  }
  return root >= 0 && system->joint[root].kind == FB_JOINT_FREE;
}

/* What the constraint of joint j connects: 2 a free tree to the ground (or to a tree on it), 1 free trees to each
   other, 0 neither. With multipliers every joint is a constraint and every body a tree. */
static int fbi_joint_ties(const fb_system *system, int j)
{
  const fb_joint *joint = &system->joint[j];
  if (system->method == FB_METHOD_MULTIPLIERS) {
    return joint->kind != FB_JOINT_FREE && joint->parent < 0 ? 2 : 1;
  }
  if (j < system->n_body || (!fbi_tree_is_free(system, joint->child) && !fbi_tree_is_free(system, joint->parent))) {
    return 0;
  }
  return fbi_tree_is_free(system, joint->child) && fbi_tree_is_free(system, joint->parent) ? 1 : 2;
}

/* Fills a system: joints, `coupled` (bodies that carry others on nodes that modes move) and `tied` (what its
   constraints connect). */
static void fbi_system_fill(fb_system *out, const fb_body *body, const fb_system_desc *desc)
{
  memset(out, 0, sizeof *out);
  out->n_body = desc->n_body;
  out->n_loop = desc->n_loop;
  out->method = desc->method;
  out->allow_long_step = desc->allow_long_step != 0;
  for (int k = 0; k < desc->n_body; k++) {
    out->model[k] = desc->model[k];
  }

  /* Joints, and what the constraints connect */
  for (int j = 0; j < desc->n_body + desc->n_loop; j++) {
    fbi_joint_fill(&out->joint[j], desc, body, j);
    if (j < desc->n_body && out->joint[j].moves) {
      out->coupled[out->joint[j].parent] = 1;
    }
  }
  for (int j = 0; j < desc->n_body + desc->n_loop; j++) {
    const int tied = fbi_joint_ties(out, j);
    out->tied = tied > out->tied ? tied : out->tied;
  }

  /* The joint of every body when multipliers enforce all joints */
  out->free.kind = FB_JOINT_FREE;
  out->free.parent = FB_GROUND;
  out->free.n_axis = fbi_traits(&out->free)->n_axis;
}

FB_DEF fb_status fb_system_init(fb_system *system, fb_system_work *work, const fb_body *body,
                                const fb_system_desc *desc, int n_model)
{
  fb_system *out;
  fb_system_state *zero;
  fb_status status;
  FBI_REQUIRE(system && work && body && desc, FB_ERR_NULL);
  FBI_REQUIRE_EXACT();

  /* The desc; work.joint names a joint that is refused */
  status = fbi_system_desc_check(body, n_model, desc);
  work->joint = -1;
  for (int j = 0; status == FB_OK && j < desc->n_body + desc->n_loop; j++) {
    status = fbi_joint_check(desc, body, j);
    work->joint = status == FB_OK ? -1 : j;
  }
  if (status != FB_OK) {
    return status;
  }

  /* Joints, room for speeds */
  out = &work->system;
  fbi_system_fill(out, body, desc);
  fbi_system_enter(work, out);
  FBI_REQUIRE(out->method != FB_METHOD_DENSE || fbi_speed_offset(out, work, body, out->n_body) <= FB_MAX_SPEEDS,
              FB_ERR_CAPACITY);

  /* State of zero coordinates at rest, locked axes freed */
  zero = &work->stage;
  memset(zero, 0, sizeof *zero);
  for (int k = 0; k < out->n_body; k++) {
    zero->link[k].quat[0] = FB_R(1.0);
    for (int i = 0; i < 3; i++) { /* a lock may be released later */
      zero->mode[k][i] = out->joint[k].mode[i] == FB_AXIS_LOCKED ? FB_AXIS_FREE : out->joint[k].mode[i];
    }
  }

  /* Mass matrix; where freed axes have no inertia, that with the locks */
  fbi_links_place(work, out, body, zero, zero);
  status = fbi_mass_factor(work, out, body, FB_R(0.0));
  if (status != FB_OK) {
    for (int k = 0; k < out->n_body; k++) {
      for (int i = 0; i < 3; i++) {
        zero->mode[k][i] = out->joint[k].mode[i];
      }
    }
    fbi_links_place(work, out, body, zero, zero);
    status = fbi_mass_factor(work, out, body, FB_R(0.0));
  }

  /* Limits of the step */
  fbi_rhs_clear(work, out, body);
  status = status == FB_OK ? fbi_speeds_solve(work, out, body) : status; /* checks free bodies, too */
  status = status == FB_OK ? fbi_system_limit(&out->limit_elastic, work, out, body, FBI_STIFFNESS) : status;
  status = status == FB_OK ? fbi_system_limit(&out->limit_damping, work, out, body, FBI_DAMPING) : status;
  status = status == FB_OK ? fbi_kept_limits(out, work, body) : status;
  if (status == FB_OK) {
    *system = *out;
  }
  return status == FB_ERR_UNDETERMINED ? FB_ERR_SINGULAR : status;
}
#endif

#if FB_WITH_EXACT
/* ---- the geometrically exact beam */

/* K += T^T D T, D = (diagonal of the forces, symmetric xx, yy, zz, xy, xz, yz of the moments); T: force strain (or
   velocity) at the point c from that at the node. */
static void fbi_section_add(fb_real K[36], const fb_real force[3], const fb_real moment[6], const fb_real c[3])
{
  const fb_real T[3][6] = {
      {FB_R(1.0), 0, 0, 0, c[2], -c[1]}, {0, FB_R(1.0), 0, -c[2], 0, c[0]}, {0, 0, FB_R(1.0), c[1], -c[0], 0}};
  const fb_real full[9] = {moment[0], moment[3], moment[4], moment[3], moment[1],
                           moment[5], moment[4], moment[5], moment[2]};
  for (int k = 0; k < 3; k++) {
    for (int i = 0; i < 6; i++) {
      fbi_vec6_add(K + 6 * i, force[k] * T[k][i], T[k]);
    }
    fbi_vec3_add(K + 6 * (k + 3) + 3, FB_R(1.0), full + 3 * k);
  }
}

/* [E10.4] Section matrices from engineering properties: K = T_t^T diag(EA, 0, 0, 0, EI_y, EI_z) T_t +
   T_s^T diag(0, GA_y, GA_z, GJ, 0, 0) T_s, inertia T_m^T diag(m, m, m, i_y + i_z, i_y, i_z) T_m, with T_t, T_s, T_m of
   tension, shear and mass center.
   Source: [L] 3.64, 3.67, 3.68; centers by their definition.  Cost: 1 kflop.  Fails: see the header.
   Test: offsets_of_a_section_are_those_of_the_forces. */
FB_DEF fb_status fb_exact_station_init(fb_exact_station *station, const fb_section *s)
{
  FBI_REQUIRE(station && s, FB_ERR_NULL);
  {
    const fb_real pull[3] = {s->EA, 0, 0}, bend[6] = {0, s->EI_y, s->EI_z, 0, 0, 0};
    const fb_real shear[3] = {0, s->GA_y, s->GA_z}, twist[6] = {s->GJ, 0, 0, 0, 0, 0};
    const fb_real mass[3] = {s->mass, s->mass, s->mass}, rotary[6] = {s->i_y + s->i_z, s->i_y, s->i_z, 0, 0, 0};
    const fb_real tension_center[3] = {0, s->tension_y, s->tension_z}, shear_center[3] = {0, s->shear_y, s->shear_z};
    const fb_real mass_center[3] = {0, s->mass_y, s->mass_z};
    const fb_real rigid[6] = {s->EA, s->GA_y, s->GA_z, s->GJ, s->EI_y, s->EI_z};
    const fb_real all[15] = {s->x,    s->mass, s->EA,    s->GJ,     s->EI_y,   s->EI_z,      s->i_y,      s->i_z,
                             s->GA_y, s->GA_z, s->twist, s->mass_y, s->mass_z, s->tension_y, s->tension_z};
    const fb_real offset[2] = {s->shear_y, s->shear_z};

    /* Finite values in range */
    const fbi_number field[] = {
        FBI_NUMBER(rigid, 6, FB_R(0.0), FB_HUGE, "EA, GA_y, GA_z [N], GJ, EI_y, EI_z [N m^2], each at least"),
        FBI_NOT_NEGATIVE(&s->mass, 1, "mass [kg/m]"),
        FBI_NOT_NEGATIVE(&s->i_y, 1, "i_y [kg m]"),
        FBI_NOT_NEGATIVE(&s->i_z, 1, "i_z [kg m]"),
        FBI_ANY(all, 15, "a number of the section"),
        FBI_ANY(offset, 2, "shear_y, shear_z [m]")};
    fb_status status;
    if (!fbi_is_finite(all, 15) || !fbi_is_finite(offset, 2)) {
      (void)fbi_numbers_check(field, FBI_LENGTH(field), -1); /* for its record */
      return FB_ERR_NOT_FINITE;
    }
    status = fbi_numbers_check(field, FBI_LENGTH(field), -1);
    if (status != FB_OK) {
      return status;
    }

    /* Matrices about tension, shear and mass center */
    memset(station, 0, sizeof *station);
    station->x = s->x;
    station->twist = s->twist;
    fbi_section_add(station->stiffness, pull, bend, tension_center);
    fbi_section_add(station->stiffness, shear, twist, shear_center);
    fbi_section_add(station->inertia, mass, rotary, mass_center);
    for (int i = 0; i < 6; i++) { /* rigid (zero) rows stay zero whatever the offsets add */
      for (int j = 0; j < 6 && rigid[i] <= FB_R(0.0); j++) {
        station->stiffness[6 * i + j] = station->stiffness[6 * j + i] = FB_R(0.0);
      }
    }
  }
  return FB_OK;
}

/* Compliance of a stiffness; rows that are rigid (zero on the diagonal) come out zero. */
static fb_status fbi_compliance(fb_real C[36], const fb_real K[36])
{
  fb_real L[36], e[6];
  fbi_copy(L, K, 36);
  for (int i = 0; i < 6; i++) {
    for (int j = 0; j < 6 && K[7 * i] == FB_R(0.0); j++) {
      L[6 * i + j] = L[6 * j + i] = i == j ? FB_R(1.0) : FB_R(0.0);
    }
  }
  if (fb_chol_factor(L, 6) != FB_OK) {
    return FB_ERR_VALUE;
  }
  for (int j = 0; j < 6; j++) {
    fbi_zero(e, 6);
    e[j] = K[7 * j] == FB_R(0.0) ? FB_R(0.0) : FB_R(1.0);
    fb_chol_solve(e, L, e, 6);
    for (int i = 0; i < 6; i++) {
      C[6 * i + j] = e[i];
    }
  }
  return FB_OK;
}

/* Inverse of a symmetric positive semidefinite matrix on its range. */
static void fbi_pseudo_inverse(fb_real Y[36], const fb_real A[36])
{
  fb_real B[36], V[36], d[6];
  fbi_copy(B, A, 36);
  fbi_zero(Y, 36);
  if (fb_eig_sym_solve(d, V, B, 6) != FB_OK) {
    return;
  }
  for (int k = 0; k < 6; k++) {
    for (int i = 0; i < 6 && d[k] > (FB_SINGLE ? FB_R(1e-6) : FB_R(1e-12)) * d[5]; i++) {
      fbi_vec6_add(Y + 6 * i, V[6 * k + i] / d[k], V + 6 * k);
    }
  }
}

static int fbi_is_symmetric6(const fb_real A[36])
{
  for (int i = 0; i < 6; i++) {
    for (int j = 0; j < i; j++) {
      const fb_real d = A[6 * i + j] - A[6 * j + i];
      if (d * d > FB_R(1e-10) * A[7 * i] * A[7 * j]) {
        return 0;
      }
    }
  }
  return 1;
}

/* Is M positive semidefinite to round-off, as an inertia of masses is? */
static int fbi_is_inertia(const fb_real M[36])
{
  fb_real A[36], V[36], d[6];
  fbi_copy(A, M, 36);
  for (int i = 0; i < 36; i++) { /* length unit that makes both halves comparable */
    const fb_real u = M[0] > FB_R(0.0) && M[21] > FB_R(0.0) ? FB_SQRT(M[0] / M[21]) : FB_R(1.0);
    A[i] *= (i / 6 > 2 ? u : FB_R(1.0)) * (i % 6 > 2 ? u : FB_R(1.0));
  }
  return fb_eig_sym_solve(d, V, A, 6) == FB_OK && d[0] >= -FB_R(1e-5) * fbi_larger(d[5], FB_R(0.0));
}

static fb_status fbi_exact_station_check(const fb_exact_desc *desc, int k)
{
  const fb_exact_station *s = &desc->station[k];
  const fbi_number field[] = {FBI_ANY(s->stiffness, 36, "station: stiffness"),
                              FBI_ANY(s->inertia, 36, "station: inertia"),
                              FBI_ANY(s->curvature, 3, "station: curvature [rad/m]"),
                              FBI_ANY(&s->twist, 1, "station: twist [rad]"), FBI_ANY(&s->x, 1, "station: x [m]")};
  fb_real C[36];
  fb_status status = fbi_numbers_check(field, FBI_LENGTH(field), k);

  /* Stiffness zero (rigid) in the same directions at all stations */
  for (int i = 0; i < 6 && status == FB_OK; i++) {
    const fb_real stiff = s->stiffness[7 * i], first = desc->station[0].stiffness[7 * i];
    if (stiff < FB_R(0.0) || (stiff > FB_R(0.0) && stiff < FB_R(1.0) / FB_HUGE)) {
      return FBI_REFUSE_AT(FB_ERR_VALUE, "station: stiffness on the diagonal, at least", k, stiff, FB_R(0.0),
                           (fb_real)i);
    }
    if (s->inertia[7 * i] < FB_R(0.0)) {
      return FBI_REFUSE_AT(FB_ERR_VALUE, "station: inertia on the diagonal, at least", k, s->inertia[7 * i], FB_R(0.0),
                           (fb_real)i);
    }
    if ((stiff == FB_R(0.0)) != (first == FB_R(0.0))) {
      return FBI_REFUSE_AT(FB_ERR_VALUE, "station: stiffness on the diagonal, 0 (rigid) if that of the first, equal to",
                           k, stiff, first, (fb_real)i);
    }
  }
  if (status != FB_OK) {
    return status;
  }

  /* Matrices, order of the stations */
  {
    const int ordered = desc->n_station < 2 || (k == 0 ? s->x == FB_R(0.0) : s->x > desc->station[k - 1].x);
    const fbi_claim claim[] = {FBI_CLAIM(fbi_is_symmetric6(s->stiffness), "station: stiffness, symmetric"),
                               FBI_CLAIM(fbi_is_symmetric6(s->inertia), "station: inertia, symmetric"),
                               FBI_CLAIM(fbi_is_inertia(s->inertia), "station: inertia, positive semidefinite"),
                               FBI_CLAIM(ordered, "station: x [m], 0 of the first, above that of the station before")};
    status = fbi_claims_check(claim, FBI_LENGTH(claim), k);
  }
  if (status == FB_OK) {
    status = fbi_compliance(C, s->stiffness);
    status = status ? FBI_REFUSE(status, "station: stiffness, positive definite where it is not rigid", k, FB_R(0.0),
                                 FB_R(0.0))
                    : FB_OK;
  }
  return status;
}

/* Linear interpolation between the stations around x. */
static void fbi_exact_station_eval(fb_exact_station *out, const fb_exact_desc *desc, fb_real x)
{
  const fb_exact_station *a = desc->station, *b = a;
  fb_real s = FB_R(0.0);
  if (desc->n_station > 1) {
    while (a + 2 < desc->station + desc->n_station && a[1].x < x) {
      a++;
    }
    b = a + 1;
    s = x < b->x ? (x - a->x) / (b->x - a->x) : FB_R(1.0);
  }

  /* Symmetric parts: the rest is round-off of the input */
  out->x = x;
  out->twist = a->twist + (b->twist - a->twist) * s;
  for (int i = 0; i < 36; i++) {
    const int t = i % 6 * 6 + i / 6;
    const fb_real Ka = a->stiffness[i] + a->stiffness[t], Kb = b->stiffness[i] + b->stiffness[t];
    const fb_real Ma = a->inertia[i] + a->inertia[t], Mb = b->inertia[i] + b->inertia[t];
    out->stiffness[i] = FB_R(0.5) * (Ka + (Kb - Ka) * s);
    out->inertia[i] = FB_R(0.5) * (Ma + (Mb - Ma) * s);
  }
  for (int i = 0; i < 3; i++) {
    out->curvature[i] = a->curvature[i] + (b->curvature[i] - a->curvature[i]) * s;
  }
}

/* Position of a node along the line: as given, or of equal elements. */
static fb_real fbi_exact_place(const fb_exact_desc *desc, int node)
{
  const int n = desc->n_element;
  return desc->place[n] != FB_R(0.0) ? desc->place[node] : desc->length * (fb_real)node / (fb_real)n;
}

/* The ends of element k must be rotated against each other by less than 3 rad (pi is the limit) before anything acts:
   integral of the initial curvature from station to station, and the twist. */
static fb_status fbi_exact_turn_check(const fb_exact_desc *desc, int k)
{
  const fb_real end = fbi_exact_place(desc, k + 1);
  fb_real at = fbi_exact_place(desc, k), turn[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)};
  fb_exact_station a, b;
  fbi_exact_station_eval(&a, desc, at);
  turn[0] = -a.twist;
  for (int s = 0; s < desc->n_station && at < end; s++) {
    const fb_real x = s + 1 < desc->n_station ? desc->station[s].x : end, next = x < end ? x : end;
    if (next > at) {
      fbi_exact_station_eval(&b, desc, next);
      for (int i = 0; i < 3; i++) {
        turn[i] += FB_R(0.5) * (a.curvature[i] + b.curvature[i]) * (next - at);
      }
      a = b;
      at = next;
    }
  }
  turn[0] += a.twist;
  return fb_vec3_dot(turn, turn) < FB_R(9.0)
             ? FB_OK
             : FBI_REFUSE(FB_ERR_VALUE, "element: rotation of its ends against each other [rad], below", k,
                          fbi_vec3_norm(turn), FB_R(3.0));
}

static int fbi_is_end(int held)
{
  return held == FB_END_FREE || (held >= 0 && held <= FB_END_CLAMPED);
}

/* Places of the nodes ascend to the length. */
static fb_status fbi_exact_places_check(const fb_exact_desc *desc)
{
  const int n = desc->n_element;
  for (int k = 0; k <= n && !fbi_is_zero(desc->place, n + 1); k++) {
    if (k == 0 ? desc->place[0] != FB_R(0.0) : !(desc->place[k] > desc->place[k - 1])) {
      return FBI_REFUSE(FB_ERR_VALUE, "node: place [m], 0 of the first, above that of the node before", k,
                        desc->place[k], k == 0 ? FB_R(0.0) : desc->place[k - 1]);
    }
  }
  if (desc->place[n] != FB_R(0.0) && FB_FABS(desc->place[n] - desc->length) > FB_R(1e-5) * desc->length) {
    return FBI_REFUSE(FB_ERR_VALUE, "node: place [m] of the last, the length, equal to", n, desc->place[n],
                      desc->length);
  }
  return FB_OK;
}

static fb_status fbi_exact_check(const fb_exact_desc *desc)
{
  const int n = desc->n_element, places = n >= 1 && n <= FB_MAX_EXACT ? n + 1 : 0;
  const fbi_count count[] = {FBI_COUNT(n, 1, FB_MAX_EXACT, "n_element, 1 to FB_MAX_EXACT, beyond"),
                             FBI_COUNT(desc->n_station, 1, FB_MAX_STATIONS, "n_station, 1 to FB_MAX_STATIONS, beyond"),
                             FBI_COUNT(desc->n_support, 0, FB_MAX_LUMPS, "n_support, 0 to FB_MAX_LUMPS, beyond"),
                             FBI_COUNT(desc->n_lump, 0, FB_MAX_LUMPS, "n_lump, 0 to FB_MAX_LUMPS, beyond")};
  const fbi_number field[] = {
      FBI_ANY(&desc->length, 1, "length [m]"),
      FBI_ANY(desc->place, places, "place [m]"),
      FBI_ANY(desc->position, 3, "position [m]"),
      FBI_ANY(desc->attitude, 4, "attitude"),
      FBI_ANY(desc->gravity, 3, "gravity [m/s^2]"),
      FBI_NUMBER(&desc->dissipation, 1, FB_R(0.0), FB_R(2.0) / FB_R(3.0), "dissipation, 0 to 2/3, beyond")};
  const fbi_count choice[] = {FBI_COUNT(desc->iterations, 0, 20, "iterations, 0 to 20, beyond"),
                              FBI_COUNT(desc->factorizations, 0, 20, "factorizations, 0 to 20, beyond")};
  const fbi_claim claim[] = {FBI_CLAIM(desc->length > FB_R(1.0) / FB_HUGE, "length [m], above 0"),
                             FBI_CLAIM(fbi_is_end(desc->root), "root, an FB_END_.."),
                             FBI_CLAIM(fbi_is_end(desc->tip), "tip, an FB_END_..")};
  fb_status status = fbi_counts_check(FB_ERR_CAPACITY, count, FBI_LENGTH(count), -1);
  status = status ? status : fbi_numbers_check(field, FBI_LENGTH(field), -1);
  status = status ? status : fbi_counts_check(FB_ERR_VALUE, choice, FBI_LENGTH(choice), -1);
  status = status ? status : fbi_claims_check(claim, FBI_LENGTH(claim), -1);
  status = status ? status : fbi_exact_places_check(desc);

  /* Stations to the length */
  for (int k = 0; k < desc->n_station && status == FB_OK; k++) {
    status = fbi_exact_station_check(desc, k);
  }
  if (status == FB_OK && desc->n_station > 1 &&
      FB_FABS(desc->station[desc->n_station - 1].x - desc->length) > FB_R(1e-5) * desc->length) {
    status = FBI_REFUSE(FB_ERR_VALUE, "station: x [m] of the last, the length, equal to", desc->n_station - 1,
                        desc->station[desc->n_station - 1].x, desc->length);
  }

  /* Supports, lumped bodies, initial rotations */
  for (int k = 0; k < desc->n_support && status == FB_OK; k++) {
    const fb_support *s = &desc->support[k];
    const fbi_count node[] = {FBI_COUNT(s->node, 0, n, "support: node, beyond")};
    const fbi_claim held[] = {FBI_CLAIM(fbi_is_end(s->held), "support: held, an FB_END_..")};
    status = fbi_counts_check(FB_ERR_CAPACITY, node, 1, k);
    status = status ? status : fbi_claims_check(held, 1, k);
  }
  status = status ? status : fbi_lumps_check(desc->lump, desc->n_lump, n);
  for (int k = 0; k < n && status == FB_OK; k++) {
    status = fbi_exact_turn_check(desc, k);
  }
  return status;
}

/* [E10.6] Compliance and inertia of an element, X = h ad(1, 0, 0, curvature):
     C + 1/12 (X C X^T + X C1 + C1 X^T)     M + 1/12 (X^T M X - X^T M1 - M1 X)
   Equilibrium and taper make the strain vary linearly over the element: the terms added to C are the relative motion of
   the ends by that (for a uniform straight beam h^2/(12 EI) of shear). The terms added to M are the energy of the
   element's rotation besides that of its mean velocity (h^2 m/12 of rotary inertia). Stretch and twist of a uniform
   straight beam have neither: their waves are those of the box scheme.
   Source: own, Magnus expansion and variance; [MN] has the straight beam's flexibility.  Cost: init only.
   Fails: never.  Test: linear_cantilevers_are_exact_at_the_nodes, a_rigid_beam_has_its_inertia,
   tapered_beams_converge_fast. */
static void fbi_exact_refine(fb_exact *m, int k, const fb_real M1[36])
{
  const fb_real *const C = m->section + 36 * k, *const C1 = m->taper + 36 * k;
  fb_real *const M = m->M + 36 * k;
  fb_real X[6], Y[36], Z[36];
  for (int i = 0; i < 6; i++) {
    X[i] = m->h[k] * m->xi[6 * k + i];
  }

  /* C + 1/12 (X C X^T + X C1 + C1 X^T) */
  fbi_ad_mul(Y, X, C);
  for (int i = 0; i < 6; i++) {
    fbi_ad(Z + 6 * i, X, Y + 6 * i); /* X Y^T, Y^T = C X^T */
  }
  fbi_ad_mul(Y, X, C1);
  for (int i = 0; i < 36; i++) {
    const int transposed = i % 6 * 6 + i / 6;
    m->C[36 * k + i] = C[i] + (FB_R(0.5) * (Z[i] + Z[transposed]) + Y[i] + Y[transposed]) / FB_R(12.0);
  }

  /* M + 1/12 (X^T M X - X^T M1 - M1 X) */
  fbi_mul_ad(Y, M, X);
  fbi_adT_mul(Z, X, Y);
  fbi_mul_ad(Y, M1, X);
  for (int i = 0; i < 36; i++) {
    const int transposed = i % 6 * 6 + i / 6;
    M[i] += (FB_R(0.5) * (Z[i] + Z[transposed]) - Y[i] - Y[transposed]) / FB_R(12.0);
  }
}

/* [E10.5] Means over an element of compliance (so that a rod of any taper is exact), inertia and curvature, and the
   change of the first two over it (taper, M1: 12 times their first moments about the middle). Stations lie anywhere;
   each stretch between them has its own Gauss quadrature.
   Source: definition.  Cost: init only.  Fails: never on a checked desc.  Test: tapered_rods_are_exact_at_the_nodes. */
static void fbi_exact_element_fill(fb_exact *m, const fb_exact_desc *desc, int k)
{
  fb_real *const C1 = m->taper + 36 * k;
  const fb_real start = fbi_exact_place(desc, k), end = fbi_exact_place(desc, k + 1), h = end - start;
  fb_exact_station at, last;
  fb_real C[36], M1[36], a = start;
  m->h[k] = h;
  fbi_zero(M1, 36);

  /* Stretches a..b between stations */
  for (int s = 0; s < desc->n_station && a < end; s++) {
    const fb_real x = desc->n_station == 1 ? end : desc->station[s].x;
    const fb_real b = x < end && s + 1 < desc->n_station ? x : end;

    /* Means and 12 times the first moments */
    for (int g = 0; g < FBI_GAUSS && b > a; g++) {
      const fb_real weight = fbi_gauss_w[g] * (b - a) / h;
      const fb_real place = a + fbi_gauss_x[g] * (b - a);
      const fb_real slope = FB_R(12.0) * weight * ((place - start) / h - FB_R(0.5));
      fbi_exact_station_eval(&at, desc, place);
      (void)fbi_compliance(C, at.stiffness);
      for (int i = 0; i < 36; i++) {
        m->section[36 * k + i] += weight * C[i];
        m->M[36 * k + i] += weight * at.inertia[i];
        C1[i] += slope * C[i];
        M1[i] += slope * at.inertia[i];
      }
      fbi_vec3_add(m->xi + 6 * k + 3, weight, at.curvature);
    }
    a = b > a ? b : a;
  }

  /* xi = (1, 0, 0, curvature with the rate of twist) */
  fbi_exact_station_eval(&at, desc, start);
  fbi_exact_station_eval(&last, desc, end);
  m->xi[6 * k] = FB_R(1.0);
  m->xi[6 * k + 3] += (last.twist - at.twist) / h;
  fbi_exact_refine(m, k, M1);
}

/* The beam's own units: its length, the force that bends it by about its length, the time in which that force moves
   its mass by about its length. Slenderness is then the only scale left. */
static void fbi_exact_units(fb_exact *m, const fb_exact_desc *desc)
{
  fb_real bend = FB_R(0.0), twist = FB_R(0.0), stretch = FB_R(0.0), mass = FB_R(0.0);
  for (int k = 0; k < m->n; k++) {
    const fb_real *C = m->section + 36 * k;
    bend += m->h[k] * fbi_larger(C[28], C[35]);
    twist += m->h[k] * C[21];
    stretch += m->h[k] * fbi_larger(C[0], fbi_larger(C[7], C[14]));
    mass += m->h[k] * fbi_larger(m->M[36 * k], m->M[36 * k + 21] / (desc->length * desc->length));
  }
  for (int k = 0; k < desc->n_lump; k++) {
    mass += desc->lump[k].mass;
  }
  m->length = desc->length;
  if (bend > FB_R(0.0) || twist > FB_R(0.0)) {
    m->force = FB_R(1.0) / (m->length * (bend > FB_R(0.0) ? bend : twist));
  } else {
    m->force = stretch > FB_R(0.0) ? m->length / stretch : FB_R(1.0);
  }
  m->time = mass > FB_R(0.0) ? FB_SQRT(mass * m->length / m->force) : FB_R(1.0);
}

/* Scales a 6x6 of the line to the beam's units: its blocks times unit, unit * length, unit * length^2. */
static void fbi_exact_scale(fb_real A[36], fb_real unit, fb_real length)
{
  for (int i = 0; i < 36; i++) {
    A[i] *= unit * (i / 6 > 2 ? length : FB_R(1.0)) * (i % 6 > 2 ? length : FB_R(1.0));
  }
}

/* Rescales a beam to its own units and fills the inverse matrices. */
static void fbi_exact_rescale(fb_exact *m, const fb_exact_desc *desc)
{
  const fb_real L = m->length, mass = m->force * m->time * m->time / L;

  /* Elements */
  for (int k = 0; k < m->n; k++) {
    m->h[k] /= L;
    for (int i = 3; i < 6; i++) {
      m->xi[6 * k + i] *= L;
    }
    fbi_exact_scale(m->section + 36 * k, m->force, L);
    fbi_exact_scale(m->taper + 36 * k, m->force, L);
    fbi_exact_scale(m->C + 36 * k, m->force, L);
    fbi_exact_scale(m->M + 36 * k, L / mass, FB_R(1.0) / L);
    if (fbi_compliance(m->S + 36 * k, m->C + 36 * k) != FB_OK) { /* rigid in a direction that is no axis */
      fbi_pseudo_inverse(m->S + 36 * k, m->C + 36 * k);
    }
    fbi_pseudo_inverse(m->M_inverse + 36 * k, m->M + 36 * k);
  }

  /* Lumped bodies */
  for (int k = 0; k < m->n_lump; k++) {
    const fb_real one = desc->lump[k].mass, mass3[3] = {one, one, one};
    m->lump_node[k] = desc->lump[k].node;
    fbi_section_add(m->lump + 36 * k, mass3, desc->lump[k].inertia, desc->lump[k].center);
    fbi_exact_scale(m->lump + 36 * k, FB_R(1.0) / mass, FB_R(1.0) / L);
    fbi_pseudo_inverse(m->lump_inverse + 36 * k, m->lump + 36 * k);
  }

  /* Gravity and position */
  for (int i = 0; i < 3; i++) {
    m->gravity[i] = desc->gravity[i] * m->time * m->time / L;
    m->r[i] = desc->position[i] / L;
  }
}

/* Constrained directions of the nodes and their poses before anything acts: the root's attitude with its twist, then
   along the line. */
static void fbi_exact_nodes_fill(fb_exact *m, const fb_exact_desc *desc, const fb_real attitude[4])
{
  fb_real turn[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)}, quat[4];
  turn[0] = desc->station[0].twist;
  fb_quat_from_rotvec(quat, turn);
  fb_quat_mul(m->quat, attitude, quat);
  fbi_exact_poses(m->r, m->quat, m, NULL, NULL);

  /* Constraints; floating: no node has any */
  m->held[0] = desc->root == FB_END_DEFAULT ? FB_END_CLAMPED : desc->root % FB_END_FREE;
  m->held[m->n] = desc->tip % FB_END_FREE;
  for (int k = 0; k < desc->n_support; k++) {
    m->held[desc->support[k].node] |= desc->support[k].held % FB_END_FREE;
  }
  m->floating = 1;
  for (int k = 0; k <= m->n; k++) {
    m->floating = m->floating && m->held[k] == 0;
  }
}

FB_DEF fb_status fb_exact_init(fb_exact *m, const fb_exact_desc *desc)
{
  fb_status status;
  fb_real attitude[4], rho;
  FBI_REQUIRE(m && desc, FB_ERR_NULL);
  FBI_REQUIRE_EXACT();
  status = fbi_exact_check(desc);
  status = status ? status : fbi_quat_from_attitude(attitude, desc->attitude);
  if (status != FB_OK) {
    return status;
  }

  /* Sizes and options */
  memset(m, 0, sizeof *m);
  m->n = desc->n_element;
  m->n_lump = desc->n_lump;
  m->iterations = desc->iterations > 0 ? desc->iterations : 6;
  m->factorizations = desc->factorizations > 0 ? desc->factorizations : 1;
  rho = FB_R(1.0) - desc->dissipation;
  m->beta = rho * (FB_R(1.0) - rho) / ((FB_R(1.0) + rho) * (FB_R(1.0) + rho));

  /* Elements, units, nodes */
  for (int k = 0; k < m->n; k++) {
    fbi_exact_element_fill(m, desc, k);
  }
  fbi_exact_units(m, desc);
  fbi_exact_rescale(m, desc);
  fbi_exact_nodes_fill(m, desc, attitude);
  return FB_OK;
}
#endif

#if FB_WITH_NONLINEAR_STRAIN
/* ---- exponential integrator */

/* Displacement of the coordinates by a unit of r at quadrature point g, K^-1 Psi_x^T EA, to work.d; work.L holds the
   factor of K. */
static void fbi_membrane_column(fb_body_work *work, const fb_body *body, int g)
{
  fbi_zero(work->d, body->n);
  for (int i = 0; i < body->n_strain_row; i++) {
    const fb_strain_row *row = &body->strain_row[i];
    work->d[row->a] += row->axis == 0 ? body->strain_weight[g] * row->slope[g] : FB_R(0.0);
  }
  fb_chol_solve(work->d, work->L, work->d, body->n);
}

/* [E11.9] Membrane coordinates s = q + G(q), G_a = sum_g G_ag r_g with r = 1/2 (u_y'^2 + u_z'^2) at the strain
   quadrature points and G = K^-1 Psi_x^T EA: then dU/dq_a of E8.23 is K s but for what the axial functions cannot
   follow. G does not depend on the coordinates that it moves, so q = s - G(s). Momenta: sigma = (1 - G'^T) pi.
   Source: point transformation of [DB] (27).  Shapes: G n_axial x points.  Fails: K singular; axial coordinates
   that bend.
   Test: membrane_coordinates_make_the_strain_linear. */
static fb_status fbi_membrane_fill(fb_exponential *scheme, fb_body_work *work, const fb_body *body)
{
  const int n = body->n;
  fb_real *moved = work->A, largest = FB_R(0.0);
  fb_status status;

  /* Largest displacement of each coordinate by any r_g */
  fbi_sparse_to_dense(work->L, &body->K, n);
  status = fb_chol_factor(work->L, n);
  fbi_zero(moved, n);
  for (int g = 0; g < body->n_strain && status == FB_OK; g++) {
    fbi_membrane_column(work, body, g);
    for (int a = 0; a < n; a++) {
      moved[a] = fbi_larger(moved[a], FB_FABS(work->d[a]));
      largest = fbi_larger(largest, moved[a]);
    }
  }

  /* Axial coordinates are those that move; they must not bend */
  for (int a = 0; a < n && status == FB_OK; a++) {
    if (moved[a] > FBI_ROUNDING * largest) {
      scheme->axial[scheme->n_axial++] = a;
    }
    for (int i = 0; i < body->n_strain_row; i++) {
      const int bends = body->strain_row[i].a == a && body->strain_row[i].axis > 0;
      status = bends && moved[a] > FBI_ROUNDING * largest ? FB_ERR_EFFECTS : status;
    }
  }

  /* Their rows of G */
  for (int g = 0; g < body->n_strain && status == FB_OK; g++) {
    fbi_membrane_column(work, body, g);
    for (int k = 0; k < scheme->n_axial; k++) {
      scheme->G[k * FBI_MAX_STRAINS + g] = work->d[scheme->axial[k]];
    }
  }
  return status;
}
#endif

/* Stumpff functions c_j = sum_k (-t^2)^k / (2k + j)!, j = 0..4: closed forms, or for small t, where those cancel, the
   series of c_3 and c_4 and c_j = 1/j! - t^2 c_(j+2). */
static void fbi_stumpff(fb_real c[5], fb_real t)
{
  const fb_real x = t * t;
  if (t < FB_R(0.5)) {
    c[3] = c[4] = FB_R(0.0);
    for (int k = 7; k >= 0; k--) { /* 1/j! (1 - x/((j+1)(j+2)) (1 - ..)) */
      c[3] = FB_R(1.0) - x * c[3] / (fb_real)((2 * k + 4) * (2 * k + 5));
      c[4] = FB_R(1.0) - x * c[4] / (fb_real)((2 * k + 5) * (2 * k + 6));
    }
    c[3] /= FB_R(6.0);
    c[4] /= FB_R(24.0);
    c[2] = FB_R(0.5) - x * c[4];
    c[1] = FB_R(1.0) - x * c[3];
    c[0] = FB_R(1.0) - x * c[2];
    return;
  }
  c[0] = FB_COS(t);
  c[1] = FB_SIN(t) / t;
  c[2] = (FB_R(1.0) - c[0]) / x;
  c[3] = (FB_R(1.0) - c[1]) / x;
  c[4] = (FB_R(0.5) - c[2]) / x;
}

static void fbi_stumpff_fill(fb_real table[5][FB_MAX_MODES], int k, fb_real t)
{
  fb_real c[5];
  fbi_stumpff(c, t);
  for (int j = 0; j < 5; j++) {
    table[j][k] = c[j];
  }
}

/* Modes of the linear part: K x = omega^2 M_free x, M_free the mass of the modes of a base that may recoil. */
static fb_status fbi_exponential_modes(fb_exponential *scheme, fb_body_work *work, const fb_body *body)
{
  const int n = body->n, first = fbi_first_free(body->base);
  fb_real *rows = work->Lambda, *M = work->Lambda + 6 * n; /* M_free = (M^-1 + B^T S_0^-1 B)^-1, B = Lambda_0 M^-1 */
  fb_real unit[FB_MAX_MODES + 1] = {FB_R(1.0)};
  fb_status status;

  /* M^-1, and the free rows of B = Lambda_0 M^-1 */
  fbi_lambda_rows(rows, body, unit, 0, body->n_lambda_constant);
  fbi_sparse_to_dense(work->A, &body->M, n);
  if (body->unit_mass) {
    fbi_copy(work->B, work->A, n * n);
  } else {
    fbi_sparse_to_dense(work->B, &body->Minv, n);
  }
  for (int i = first; i < 6; i++) {
    fbi_mass_solve(work->d, body, rows + i * n);
    fbi_copy(rows + i * n, work->d, n);
  }

  /* M^-1 + B^T S_0^-1 B */
  for (int i = first; i < 6; i++) {
    for (int j = first; j < 6; j++) {
      for (int a = 0; a < n; a++) {
        fbi_row_sub(work->B + a * n, -body->S0_inverse[6 * i + j] * rows[i * n + a], rows + j * n, n);
      }
    }
  }

  /* M_free, the inverse of that */
  status = fb_chol_factor(work->B, n);
  for (int a = 0; a < n && status == FB_OK; a++) {
    fbi_zero(work->d, n);
    work->d[a] = FB_R(1.0);
    fb_chol_solve(M + a * n, work->B, work->d, n);
  }
  if (status != FB_OK) {
    return status;
  }

  /* Modes X and M_free X */
  fbi_sparse_to_dense(work->A, &body->K, n);
  fbi_copy(work->B, M, n * n);
  status = fb_eig_gen_solve(scheme->omega2, scheme->X, work->A, work->B, n);
  for (int k = 0; k < n && status == FB_OK; k++) {
    fbi_zero(scheme->MX + k * n, n);
    for (int a = 0; a < n; a++) {
      fbi_row_sub(scheme->MX + k * n, -scheme->X[k * n + a], M + a * n, n);
    }
    status = scheme->omega2[k] > FB_R(0.0) ? status : FB_ERR_SINGULAR;
  }
  return status;
}

FB_DEF fb_status fb_exponential_init(fb_exponential *scheme, fb_body_work *work, const fb_body *body, fb_real dt)
{
  fb_exponential out;
  fb_status status = FB_OK;
  FBI_REQUIRE(scheme && work && body, FB_ERR_NULL);
  FBI_REQUIRE_EXACT();
  if (!(dt > FB_R(0.0) && dt < FB_HUGE) || fbi_form(body) != 0) {
    return FB_ERR_VALUE;
  }

  /* Modes, membrane coordinates, Stumpff functions of half and full steps */
  memset(&out, 0, sizeof out);
  out.dt = dt;
  if (body->n > 0) {
    status = fbi_exponential_modes(&out, work, body);
  }
#if FB_WITH_NONLINEAR_STRAIN
  if (status == FB_OK && fbi_has(body->effects, FB_EFFECT_NONLINEAR_STRAIN)) {
    status = fbi_membrane_fill(&out, work, body);
  }
#endif
  for (int k = 0; k < body->n && status == FB_OK; k++) {
    fbi_stumpff_fill(out.half, k, FB_R(0.5) * dt * FB_SQRT(out.omega2[k]));
    fbi_stumpff_fill(out.full, k, dt * FB_SQRT(out.omega2[k]));
  }
  if (status == FB_OK) {
    *scheme = out;
  }
  return status;
}
#endif /* FB_WITH_BUILD */

#if FB_WITH_ANALYSE
/* ---------------------------------------------------------------------------------------------------------------
   ANALYSE >>trim: steady states and their paths
   (uses config, status, vec3, rotation, solve, body, system, exact, eigen) */

#if FB_WITH_EXACT
/* ---- steady states of the geometrically exact beam */

/* Chooses the next pivot, 1x1 (a) or 2x2 (a, b), of the n rows listed in `left` and returns its size. Rows below
   `first` are eliminated before the others: by the largest diagonal element that exceeds round-off (rigid strains have
   none), else by the largest off-diagonal one. An off-diagonal pair counts as the smaller of its two elements. */
static int fbi_pivot_find(int *a, int *b, const fb_real *A, int size, const int *left, int n, int first)
{
  fb_real on = FB_R(0.0), early = FBI_ROUNDING, off[2] = {FB_R(0.0), FB_R(0.0)};
  int p = 0, is_early = 0, row[2] = {0, 0}, column[2] = {0, 0}, rigid, alone;

  /* Largest diagonal element */
  for (int i = 0; i < n; i++) {
    const fb_real entry = FB_FABS(A[size * left[i] + left[i]]);
    if (left[i] < first && entry > early) {
      early = entry;
      is_early = 1;
      p = i;
    } else if (entry > on && !is_early) {
      on = entry;
      p = i;
    }
  }

  /* Largest off-diagonal pair: [1] with a row below `first`, [0] without */
  for (int i = 0; i < n && !is_early; i++) {
    for (int j = 0; j < i; j++) {
      const fb_real one = FB_FABS(A[size * left[i] + left[j]]), other = FB_FABS(A[size * left[j] + left[i]]);
      const fb_real entry = one < other ? one : other;
      const int k = left[i] < first || left[j] < first;
      row[k] = entry > off[k] ? i : row[k];
      column[k] = entry > off[k] ? j : column[k];
      off[k] = entry > off[k] ? entry : off[k];
    }
  }

  /* 1x1 unless a pair is needed, or larger by the factor of Bunch and Parlett (1 + sqrt(17))/8 = 0.64 */
  rigid = off[1] > FBI_ROUNDING;
  alone = is_early || (!rigid && on >= FB_R(0.64) * off[0]);
  *a = alone ? p : row[rigid];
  *b = column[rigid];
  return alone ? 1 : 2;
}

/* Scales rows and columns of A by the same factors, A_ij s_i s_j, so that the largest element of each is near 1. */
static void fbi_equilibrate(fb_real *A, int n)
{
  for (int pass = 0; pass < 4; pass++) {
    fb_real scale[12];
    for (int i = 0; i < n; i++) {
      fb_real largest = FB_R(0.0);
      for (int j = 0; j < n; j++) {
        largest = fbi_larger(largest, FB_FABS(A[n * i + j]));
      }
      scale[i] = largest > FB_R(0.0) ? FB_R(1.0) / FB_SQRT(largest) : FB_R(1.0);
    }
    for (int i = 0; i < n * n; i++) {
      A[i] *= scale[i / n] * scale[i % n];
    }
  }
}

/* [E10.19] Number of negative eigenvalues of a symmetric A (n <= 12, overwritten): that of its block-diagonal factor
   with pivots of 1x1 and 2x2 (Sylvester's law of inertia; Bunch and Parlett). Rows below `first` are eliminated first.
   Of a slightly unsymmetric A it counts the real negative eigenvalues, up to an even number.
   Source: [GV] 4.4.  Cost: n^3 flops.  Fails: never.
   Test: columns_have_as_many_unstable_directions_as_loads_exceeded. */
static int fbi_negatives(fb_real *A, int n, int first)
{
  int left[12], count = 0, size, row, column;
  for (int i = 0; i < n; i++) {
    left[i] = i;
  }
  fbi_equilibrate(A, n);

  /* Elimination, pivot by pivot */
  for (int rest = n; rest > 0; rest -= size) {
    fb_real det, trace;
    size = fbi_pivot_find(&row, &column, A, n, left, rest, first);
    {
      /* Pivot P, with 1 for the missing row of a 1x1, and its negative eigenvalues */
      const int a = left[row], b = left[column];
      const fb_real P0 = A[n * a + a], P1 = size > 1 ? A[n * a + b] : FB_R(0.0);
      const fb_real P2 = size > 1 ? A[n * b + a] : FB_R(0.0), P3 = size > 1 ? A[n * b + b] : FB_R(1.0);
      det = P0 * P3 - P1 * P2;
      trace = P0 + P3;
      count += det < FB_R(0.0) ? 1 : size > 1 && trace < FB_R(0.0) ? 2 : 0;

      /* Schur complement of the rows that are left: A -= x P^-1 x^T */
      left[row] = left[rest - 1];
      if (size > 1) { /* column < row: it has not moved */
        left[column] = left[rest - 2];
      }
      for (int i = 0; i < rest - size && det != FB_R(0.0); i++) {
        fb_real *const x = A + n * left[i];
        const fb_real x_b = size > 1 ? x[b] : FB_R(0.0);
        const fb_real y_a = (x[a] * P3 - x_b * P2) / det, y_b = (x_b * P0 - x[a] * P1) / det;
        for (int j = 0; j < rest - size; j++) {
          x[left[j]] -= y_a * A[n * a + left[j]] + y_b * A[n * b + left[j]];
        }
      }
    }
  }
  return count;
}

/* Multiplies the factors: A = P^T L U. Where the force rows of E10.10 are in base axes, the node's columns (from `own`
   on) are rotated to base axes, too. Constrained components have the row of the identity: their columns have no
   influence. */
static void fbi_exact_unfactor(fb_real *A, const fb_real *LU, const int *perm, const fb_exact_work *work,
                               const fb_exact *m, int node, int n, int own)
{
  for (int i = 0; i < n; i++) {
    fb_real *const row = A + n * perm[i];
    for (int j = 0; j < n; j++) {
      row[j] = j < i ? FB_R(0.0) : LU[n * i + j];
      for (int k = 0; k < i && k <= j; k++) {
        row[j] += LU[n * i + k] * LU[n * k + j];
      }
    }
    if (fbi_exact_turned(m->held[node])) {
      fbi_exact_rows_turn(row + own, work->R + 9 * node, 1);
    }
  }
}

/* [E10.20] Number of unstable directions of a steady state that E10.10 has factored: negative eigenvalues of the
   tangent stiffness condensed to the nodes, K + D^T (h C)^-1 D. They are those of (-h C, D; D^T, K) less six for the
   internal forces of each element, rigid or not. The elimination gives them block by block, since inertia is additive
   over Schur complements. What E10.9 adds to D^T in the columns of the internal forces is a multiple of h C and is
   eliminated with it.
   Source: [GV] 4.4; [HY].  Cost: 4 kflops an element.
   Fails: never, once factored.
   Test: columns_have_as_many_unstable_directions_as_loads_exceeded, arches_snap_at_their_limit_load. */
static int fbi_exact_unstable(const fb_exact_work *work, const fb_exact *m)
{
  fb_real A[144];
  int count = 0;
  for (int k = 0; k < m->n; k++) {
    fbi_exact_unfactor(A, work->LU + 144 * k, work->perm + 12 * k, work, m, k + 1, 12, 6);
    for (int i = 0; i < 72; i++) {
      A[i] = -A[i];
    }
    count += fbi_negatives(A, 12, 6) - 6;
  }
  fbi_exact_unfactor(A, work->root, work->perm + 12 * m->n, work, m, 0, 6, 0);
  return count + fbi_negatives(A, 6, 0);
}

/* Convergence tolerance on the last Newton correction; the next one would be about its square. */
#define FBI_EXACT_TOLERANCE (FB_SINGLE ? FB_R(1e-4) : FB_R(1e-9))
/* Adds the correction; FB_ERR_CONVERGENCE where `change`, its relative size, reaches 100 or it rotates neighboring
   nodes by more than a radian against each other. */
static fb_status fbi_exact_turn_add(fb_exact_work *work, const fb_exact *m, fb_real change)
{
  fb_status status = change < FB_R(100.0) ? FB_OK : FB_ERR_CONVERGENCE;
  for (int k = 0; k < m->n; k++) {
    for (int i = 3; i < 6; i++) {
      const fb_real turn = work->dd[6 * k + 6 + i] - work->dd[6 * k + i];
      status = turn * turn < FB_R(1.0) ? status : FB_ERR_CONVERGENCE;
    }
  }
  for (int j = 0; j <= m->n && status == FB_OK; j++) {
    fbi_pose_add(work->r + 3 * j, work->quat + 4 * j, work->dd + 6 * j);
  }
  for (int i = 0; i < 6 * m->n && status == FB_OK; i++) {
    work->s[i] += work->ds[i];
  }
  return status;
}

/* [E10.11] Newton's method for a steady state: the beam moves as a rigid body with the twist of its base, under `part`
   of the loads.
   Source: [L] 3.106.  Cost: E10.10 per iteration.  Fails: 25 iterations; neighboring nodes rotated by more than a
   radian against each other in one.
   Test: newton_converges_quadratically, steady_bend_of_an_arc_matches_the_published_tip. */
static fb_status fbi_exact_newton(fb_exact_work *work, const fb_exact *m, const fb_real base_quat[4],
                                  const fb_exact_input *input, fb_real part)
{
  fb_status status = FB_OK;
  fb_real change = FB_R(1.0), before = FB_HUGE;
  const fbi_exact_motion steady = {0, 0, 0, 0, FB_R(1.0), FB_R(0.0)};

  /* Steady motion; without angular velocity there are no inertia forces */
  work->motion = steady;
  fbi_exact_input_take(work, m, base_quat, input, part, FB_R(0.0));
  work->motion.inertia = !fbi_is_zero(work->twist + 3, 3);
  fbi_zero(work->momentum, 6 * m->n);
  fbi_zero(work->lump, 6 * m->n_lump);

  /* Corrections: residual, tangent, solution; from the tenth on they must decrease */
  for (int it = 0; it < 25 && change > FBI_EXACT_TOLERANCE && status == FB_OK; it++) {
    fbi_exact_nodes_eval(work, m);
    fbi_exact_residual(work, m);
    fbi_exact_want(work, m, FB_R(0.0), 1);
    status = fbi_exact_factor(work, m);
    if (status != FB_OK) {
      break;
    }
    fbi_exact_solve(work, m);
    work->iterations++;
    change = fbi_exact_change(work, m, FB_R(1.0), it > 3 ? FB_EPSILON : FB_R(0.0)); /* round-off apart */
    status = it > 8 && change > before ? FB_ERR_CONVERGENCE : fbi_exact_turn_add(work, m, change);
    before = change;
  }
  if (status == FB_OK && change > FBI_EXACT_TOLERANCE) {
    status = FB_ERR_CONVERGENCE;
  }
  return status;
}

/* Load increments from the undeformed beam on: a step that converges quickly doubles the next, one that does not is
   quartered. */
static fb_status fbi_exact_increments(fb_exact_work *work, const fb_exact *m, const fb_real base_quat[4],
                                      const fb_exact_input *input)
{
  fb_real part = FB_R(0.0), step = FB_R(0.5);
  fb_status status = FB_OK;

  /* Undeformed beam */
  fbi_copy(work->state.r, m->r, 3 * (m->n + 1));
  fbi_copy(work->state.quat, m->quat, 4 * (m->n + 1));
  fbi_zero(work->state.stress[0], 6 * m->n);

  /* Increments up to the full load */
  while (part < FB_R(1.0)) {
    const fb_real next = part + step < FB_R(0.999) ? part + step : FB_R(1.0);
    const int before = work->iterations;
    fbi_exact_pose_take(work, &work->state, m);
    status = fbi_exact_newton(work, m, base_quat, input, next);
    work->increments++;
    if (status == FB_OK) {
      part = next;
      step *= work->iterations - before < 6 ? FB_R(2.0) : FB_R(1.0);
      fbi_exact_pose_copy(&work->state, work, m);
    } else {
      step *= FB_R(0.25);
    }
    if (step < FB_R(1e-4) || work->increments > 500) {
      return status == FB_ERR_SINGULAR ? FB_ERR_SINGULAR : FB_ERR_CONVERGENCE;
    }
  }
  return FB_OK;
}

/* Writes the steady state of the work and the number of its unstable directions. Velocities are relative to the
   translation of the base, which goes to state->u in inertial axes. */
static void fbi_exact_rest(fb_exact_state *state, fb_exact_work *work, const fb_exact *m)
{
  fb_real base[9];
  fbi_exact_nodes_eval(work, m);
  fbi_exact_residual(work, m);
  work->unstable = fbi_exact_unstable(work, m);
  fbi_copy(work->drift, work->twist, 3);
  fbi_zero(work->twist, 3); /* from here on relative to the present velocity of the base */
  fbi_exact_nodes_eval(work, m);
  fbi_exact_state_take(state, work, m);
  fb_quat_to_mat33(base, state->base_quat);
  fb_mat33_mul_vec3(state->u, base, work->drift);
  for (int i = 0; i < 3; i++) {
    state->u[i] *= m->length / m->time;
  }
}

FB_DEF fb_status fb_exact_trim(const fb_exact *m, fb_exact_state *state, fb_exact_work *work,
                               const fb_exact_input *input)
{
  /* Check the arguments */
  fb_status status;
  FBI_REQUIRE(m && state && work, FB_ERR_NULL);
  input = input ? input : fbi_exact_no_input(work);
  status = fb_exact_state_check(m, state);
  status = status ? status : fbi_exact_input_check(m, input);
  if (status != FB_OK) {
    return status;
  }

  /* The full load at once, else in increments */
  work->iterations = 0;
  work->increments = 1;
  fbi_exact_pose_take(work, state, m);
  status = fbi_exact_newton(work, m, state->base_quat, input, FB_R(1.0));
  if (status != FB_OK) {
    status = fbi_exact_increments(work, m, state->base_quat, input);
  }
  if (status == FB_OK) {
    fbi_exact_rest(state, work, m);
  }
  return status;
}
#endif

/* Velocities V = (v, w) of a free body that spins steadily, at |wanted| about the principal axis nearest to `wanted`.
   momenta: (p, h) about the origin O at w = e_i, i = 1 2 3: p = e_i x c, h = J e_i with c = mass times the center of
   mass. mass > 0: the center of mass is at rest, J about it; 0: O is fixed. */
static fb_status fbi_free_spin(fb_real V[6], const fb_real momenta[18], fb_real mass, const fb_real wanted[3])
{
  const fb_real spin = FB_SQRT(fb_vec3_dot(wanted, wanted));
  fb_real J[9], axes[9], value[3], c[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)}, most = FB_R(0.0);
  fb_status status;
  fbi_vec6_zero(V);
  if (!fbi_is_finite(&spin, 1)) {
    return FB_ERR_NOT_FINITE;
  }

  /* First moment c, and J about the center of mass: J_O - (c.c 1 - c c^T)/mass */
  for (int i = 0; i < 3; i++) {
    const fb_real *const p = momenta + 6 * i;
    fbi_copy(J + 3 * i, p + 3, 3);
    c[(i + 1) % 3] += FB_R(0.5) * p[(i + 2) % 3]; /* e_i x c has c_(i+1) in i + 2 and -c_(i+2) in i + 1 */
    c[(i + 2) % 3] -= FB_R(0.5) * p[(i + 1) % 3];
  }
  for (int i = 0; i < 9 && mass > FB_R(0.0); i++) {
    const fb_real square = i % 4 == 0 ? fb_vec3_dot(c, c) : FB_R(0.0);
    J[i] -= (square - c[i / 3] * c[i % 3]) / mass;
  }

  /* w along the projection of `wanted` on a principal axis, or on the space of all with the same inertia */
  status = fb_eig_sym_solve(value, axes, J, 3);
  for (int k = 0; k < 3 && status == FB_OK; k++) {
    fb_real along[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)}, size;
    for (int i = 0; i < 3; i++) {
      if (FB_FABS(value[i] - value[k]) <= FBI_ROUNDING * value[2]) {
        fbi_vec3_add(along, fb_vec3_dot(axes + 3 * i, wanted), axes + 3 * i);
      }
    }
    size = fbi_vec3_norm(along);
    if (size > most) {
      most = size;
      fbi_zero(V + 3, 3);
      fbi_vec3_add(V + 3, spin / size, along);
    }
  }

  /* Center of mass at rest: mass v + w x c = 0 */
  if (mass > FB_R(0.0)) {
    fb_vec3_cross(V, c, V + 3);
    for (int i = 0; i < 3; i++) {
      V[i] /= mass;
    }
  }
  return status;
}

/* Relative tolerance of equilibrium: a resultant below this part of the summed magnitudes counts as round-off. */
#define FBI_UNREST (FB_SINGLE ? FB_R(1e-3) : FB_R(1e-6))
/* Is a base with momenta P, L (inertial axes) in steady rotation: P' = 0, L' = w x L, up to FBI_UNREST times `torque`,
   the summed magnitudes of what acts [N m]? Forces count with the lever `length`. */
static int fbi_is_balanced(const fb_real P_dot[3], const fb_real L_dot[3], const fb_real L[3], const fb_real w[3],
                           fb_real length, fb_real torque)
{
  fb_real miss[3];
  fb_vec3_cross(miss, L, w);
  fbi_vec3_add(miss, FB_R(1.0), L_dot);
  return fbi_vec3_norm(miss) + length * fbi_vec3_norm(P_dot) <=
         FBI_UNREST * (torque + fbi_vec3_norm(w) * fbi_vec3_norm(L));
}

/* Step of the finite differences, relative to the size of the body, or in radians. */
#define FBI_DIFFERENCE (FB_SINGLE ? FB_R(1e-2) : FB_R(1e-3))
/* Finite-difference step of modal coordinate a: it moves no point by more than FBI_DIFFERENCE times the radius of
   gyration (or the deflection limit, where that is smaller) and rotates no node by more than FBI_DIFFERENCE radians,
   since bodies and loads on a node rotate with it. */
static fb_real fbi_difference_step(const fb_body *body, int a)
{
  const fb_real large =
      body->gyration > FB_R(0.0) && body->gyration < body->deflection_limit ? body->gyration : body->deflection_limit;
  fb_real most = body->reach[a] / large;
  for (int k = 0; k < body->n_node; k++) {
    most = fbi_larger(most, fbi_vec3_norm(body->node[k].theta + 3 * a));
  }
  return most > FB_R(0.0) ? FBI_DIFFERENCE / most : FB_R(1.0);
}

/* ---- finite differences: the subject, a body or a system of bodies */

typedef struct fbi_subject {
  const fb_body *body;        /* or the array of models */
  const fb_linear_desc *desc; /* f: rates and the outputs of this; NULL: residual of the equilibrium (trim) */
  fb_analyse_work *work;
  const fb_state *state;
  const fb_input *input;
#if FB_WITH_SYSTEM
  const fb_system *system; /* NULL: one body */
  fb_system_analyse_work *system_work;
  const fb_system_state *system_state;
  const fb_system_input *system_input;
#endif
} fbi_subject;

/* Displaces a frame by h along (i < 3), or rotates it by h about (i >= 3), one of its own axes. */
static void fbi_frame_move(fb_real rho[3], fb_real quat[4], int i, fb_real h)
{
  fb_real x[6] = {FB_R(0.0)}, R[9], shift[3], turn[4], before[4];
  x[i] = h;
  fb_quat_to_mat33(R, quat);
  fb_mat33_mul_vec3(shift, R, x);
  fbi_vec3_add(rho, FB_R(1.0), shift);
  fb_quat_from_rotvec(turn, x + 3);
  fbi_copy(before, quat, 4);
  fb_quat_mul(quat, before, turn);
}

/* Velocity of a frame relative to a reference frame at rho_0, quat_0 that moves with v_0, w_0, in axes of the
   reference: R_0^T rho' - v_0 - w_0 x R_0^T (rho - rho_0). */
static void fbi_shift_rate(fb_real rate[3], const fb_real quat0[4], const fb_real rho0[3], const fb_real V0[6],
                           const fb_real rho[3], const fb_real velocity[3])
{
  fb_real R0[9], step[3], away[3], turn[3];
  fb_quat_to_mat33(R0, quat0);
  for (int i = 0; i < 3; i++) {
    step[i] = rho[i] - rho0[i];
  }
  fb_mat33_mulT_vec3(rate, R0, velocity);
  fb_mat33_mulT_vec3(away, R0, step);
  fb_vec3_cross(turn, V0 + 3, away);
  for (int i = 0; i < 3; i++) {
    rate[i] -= V0[i] + turn[i];
  }
}

/* Angular velocity of the frame relative to the reference, in its own axes: w - (R_0^T R)^T w_0; to first order the
   rate of the small angles between the two. */
static void fbi_turn_rate(fb_real rate[3], const fb_real quat0[4], const fb_real w0[3], const fb_real quat[4],
                          const fb_real w[3])
{
  fb_real R[9], R0[9], carried[3];
  fb_quat_to_mat33(R, quat);
  fb_quat_to_mat33(R0, quat0);
  fb_mat33_mul_vec3(carried, R0, w0);
  fb_mat33_mulT_vec3(rate, R, carried);
  for (int i = 0; i < 3; i++) {
    rate[i] = w[i] - rate[i];
  }
}

/* Rate of the body-axes components of a vector P given in inertial axes: R^T P' - w x R^T P. */
static void fbi_turned_rate(fb_real rate[3], const fb_real R[9], const fb_real w[3], const fb_real P[3],
                            const fb_real P_dot[3])
{
  fb_real p[3], turn[3];
  fb_mat33_mulT_vec3(p, R, P);
  fb_mat33_mulT_vec3(rate, R, P_dot);
  fb_vec3_cross(turn, w, p);
  fbi_vec3_add(rate, -FB_R(1.0), turn);
}

/* ---- input and output channels (ports) */

static void fbi_port_load(fb_load *load, const fb_port *port, fb_real h)
{
  memset(load, 0, sizeof *load);
  load->node = port->node;
  load->axes = FB_AXES_BODY;
  (port->kind == FB_PORT_FORCE ? load->force : load->torque)[port->axis] = h;
}

/* Output y at a node of a body. */
static fb_status fbi_port_read(fb_real *y, const fb_body *body, const fb_state *state, const fb_motion *motion,
                               const fb_port *port)
{
  const fb_real *gravity = NULL;
  fb_node_motion node;
  fb_imu imu;
  const fb_status status = fb_body_node_motion_eval(body, &node, state, motion, port->node);
#if FB_WITH_GRAVITY
  gravity = fbi_has(body->effects, FB_EFFECT_GRAVITY) ? body->gravity : NULL;
#endif
  if (status == FB_OK) {
    fb_imu_eval(&imu, &node, gravity);
    *y = port->kind == FB_PORT_DISPLACEMENT ? node.displacement[port->axis]
         : port->kind == FB_PORT_ROTATION   ? node.rotation[port->axis]
         : port->kind == FB_PORT_RATE       ? imu.angular_rate[port->axis]
                                            : imu.specific_force[port->axis];
  }
  return status;
}

/* ---- residual and response of one body */

static fb_status fbi_analyse_check(const fb_body *body, const fb_state *state, const fb_input *input)
{
  FBI_REQUIRE(body && state && input, FB_ERR_NULL);
  if (fbi_form(body) != 0 && body->base != FB_BASE_PRESCRIBED) { /* in the other forms u, L are velocities */
    return FB_ERR_VALUE;
  }
  return fb_state_check(body, state);
}

/* Momenta (p, h) about O of a body whose base is not prescribed, body axes. */
static void fbi_momenta_about_origin(fb_real ph[6], const fb_body *body, const fb_state *state, const fb_real R[9])
{
  fb_real u[3], c[3];
  fb_mat33_mulT_vec3(u, R, state->u);
  fb_mat33_mulT_vec3(ph + 3, R, state->L);
  fbi_zero(ph, 3);
  if (body->base == FB_BASE_FREE) {
    fbi_vec3_add(ph, body->mass, u);
    fbi_center_eval(c, body, state->q);
    fbi_vec3_add_cross(ph + 3, c, u);
  }
}

/* State with the given velocities. With a prescribed base the elastic momenta are those relative to the ground, which
   does not move with the base. */
static fb_status fbi_state_of(const fb_body *body, fb_state *state, const fb_real v[3], const fb_real w[3],
                              const fb_real *q_dot)
{
  const fb_status status = fb_state_from_velocity(body, state, v, w, q_dot);
  if (status == FB_OK && fbi_is_following(body)) {
    const fb_real back[3] = {-state->u[0], -state->u[1], -state->u[2]};
    fb_real R[9];
    fb_quat_to_mat33(R, state->quat);
    fbi_frame_shift(state->pi, body, state->q, R, back);
    fbi_zero(state->u, 3);
  }
  return status;
}

/* Velocities of a freely spinning base at the deformation q of the state, whose momenta are overwritten. */
static fb_status fbi_body_spin(fb_real V[6], fb_state *state, const fb_body *body, const fb_real wanted[3])
{
  const fb_real still[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)};
  fb_real R[9], momenta[18];
  fb_status status = FB_OK;
  fbi_zero(V, 3);
  fbi_copy(V + 3, wanted, 3);
  if (body->base == FB_BASE_HINGED || !(fb_vec3_dot(wanted, wanted) > FB_R(0.0))) {
    return FB_OK;
  }

  /* Momenta by a unit angular velocity about each axis */
  fb_quat_to_mat33(R, state->quat);
  for (int i = 0; i < 3 && status == FB_OK; i++) {
    fb_real w[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)};
    w[i] = FB_R(1.0);
    status = fb_state_from_velocity(body, state, still, w, NULL);
    fbi_momenta_about_origin(momenta + 6 * i, body, state, R);
  }
  return status ? status : fbi_free_spin(V, momenta, body->base == FB_BASE_FREE ? body->mass : FB_R(0.0), wanted);
}

/* Residual of the trim: pi_dot at q_dot = 0, with q_j increased by h; the base moves as the input prescribes, or spins
   freely. */
static fb_status fbi_body_residual(fb_real *f, const fbi_subject *s, int j, fb_real h)
{
  fb_analyse_work *const work = s->work;
  fb_real V[6];
  fb_status status = FB_OK;
  work->moved = *s->state;
  work->moved.q[j] += h;
  if (s->body->base == FB_BASE_PRESCRIBED) {
    fbi_copy(V, s->input->v, 3);
    fbi_copy(V + 3, s->input->w, 3);
  } else {
    status = fbi_body_spin(V, &work->moved, s->body, s->input->w);
  }
  status = status ? status : fbi_state_of(s->body, &work->moved, V, V + 3, NULL);
  status = status ? status : fb_body_rates_eval(s->body, &work->rate, &work->moved, s->input);
  if (status == FB_OK) {
    fbi_copy(f, work->rate.pi, s->body->n);
  }
  return status;
}

/* Magnitude of the component of x perpendicular to the spin axis w; 0 without spin. */
static fb_real fbi_across(const fb_real w[3], const fb_real x[3])
{
  const fb_real spin = fbi_vec3_norm(w);
  fb_real turn[3];
  fb_vec3_cross(turn, w, x);
  return spin > FB_R(0.0) ? fbi_vec3_norm(turn) / spin : FB_R(0.0);
}

/* Is the base of the trimmed state in equilibrium, too? FB_ERR_UNREST where force or torque accelerate it, now or after
   it has rotated further: loads in inertial axes and gravity need to be along the spin axis. */
static fb_status fbi_body_rest(fb_analyse_work *work, const fb_body *body, const fb_input *input)
{
  const fb_real length = body->gyration, none[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)};
  fb_real w[3], push[3], R[9], torque = FB_R(0.0), across = FB_R(0.0);
  const fb_status status = fb_body_motion_eval(body, &work->motion, &work->moved, input);
  if (status != FB_OK || body->base == FB_BASE_PRESCRIBED) {
    return status;
  }

  /* Summed magnitudes of loads and gravity; `across`: of what rotates relative to the body */
  fb_quat_to_mat33(R, work->moved.quat);
  fb_mat33_mul_vec3(w, R, work->motion.w);
  for (int i = 0; i < input->n_load; i++) {
    const fb_load *const load = &input->load[i];
    const fb_real *const seen = load->axes == FB_AXES_INERTIAL ? w : none;
    torque += fbi_vec3_norm(load->torque) + length * fbi_vec3_norm(load->force);
    across += fbi_across(seen, load->torque) + length * fbi_across(seen, load->force);
  }
#if FB_WITH_GRAVITY
  if (fbi_has(body->effects, FB_EFFECT_GRAVITY)) {
    torque += body->mass * length * fbi_vec3_norm(body->gravity);
    across += body->mass * length * fbi_across(w, body->gravity);
  }
#endif

  /* P' = 0, L' = w x L, now and later */
  fbi_zero(push, 3);
  fbi_vec3_add(push, body->mass, work->rate.u);
  return fbi_is_balanced(push, work->rate.L, work->moved.L, w, length, torque) && across <= FBI_UNREST * torque
             ? FB_OK
             : FB_ERR_UNREST;
}

/* State with element j of x increased by h; x = (q, pi, momenta of the base, position and attitude). With q the
   velocities stay constant and the momenta change (E12.12); with the attitude the momenta keep their components in body
   axes. */
static fb_status fbi_linear_move(fb_state *out, const fbi_subject *s, int j, fb_real h)
{
  const fb_motion *const steady = &s->work->steady;
  const fb_body *const body = s->body;
  const fb_state *const state = s->state;
  const int n = body->n, first = fbi_first_free(body->base), momentum = j - 2 * n + first,
            pose = momentum - (6 - first);
  fb_real R[9], ph[6];
  *out = *state;

  /* q */
  if (j < n) {
    out->q[j] += h;
    return fbi_state_of(body, out, steady->v, steady->w, steady->q_dot);
  }

  /* pi, else momenta or pose of the base */
  if (j < 2 * n) {
    out->pi[j - n] += h;
  } else {
    fb_quat_to_mat33(R, state->quat);
    fb_mat33_mulT_vec3(ph, R, state->u);
    fb_mat33_mulT_vec3(ph + 3, R, state->L);
    if (momentum < 6) {
      ph[momentum] += momentum < 3 ? h / body->mass : h;
    } else {
      fbi_frame_move(out->rho, out->quat, pose, h);
      fb_quat_to_mat33(R, out->quat);
    }
    fb_mat33_mul_vec3(out->u, R, ph);
    fb_mat33_mul_vec3(out->L, R, ph + 3);
  }
  return FB_OK;
}

/* Rates of the momenta of the base and of its pose, body axes; the pose relative to the steady motion. */
static void fbi_linear_frame(fb_real rate[12], const fb_analyse_work *work, const fb_state *state, fb_real mass)
{
  const fb_state *const at = &work->moved;
  const fb_real *const w = work->motion.w;
  fb_real R[9], V0[6], velocity[3];
  fbi_copy(V0, work->steady.v, 3);
  fbi_copy(V0 + 3, work->steady.w, 3);
  fb_quat_to_mat33(R, at->quat);
  fb_mat33_mul_vec3(velocity, R, work->motion.v);
  fbi_turned_rate(rate, R, w, at->u, work->rate.u);
  for (int i = 0; i < 3; i++) {
    rate[i] *= mass;
  }
  fbi_turned_rate(rate + 3, R, w, at->L, work->rate.L);
  fbi_shift_rate(rate + 6, state->quat, state->rho, V0, at->rho, velocity);
  fbi_turn_rate(rate + 9, state->quat, V0 + 3, at->quat, w);
}

/* Increases an input by h. */
static void fbi_port_drive(fb_input *input, const fb_port *port, fb_real h)
{
  if (port->kind == FB_PORT_BASE_VELOCITY || port->kind == FB_PORT_BASE_RATE) {
    (port->kind == FB_PORT_BASE_VELOCITY ? input->v : input->w)[port->axis] += h;
  } else {
    fbi_port_load(&input->load[input->n_load], port, h);
    input->n_load++;
  }
}

/* Momenta of the linear model: those of the modes, then the free ones of the base, body axes. */
static void fbi_linear_momenta(fb_real *p, const fb_body *body, const fb_state *state)
{
  const int n = body->n, first = fbi_first_free(body->base);
  fb_real R[9], ph[6];
  fb_quat_to_mat33(R, state->quat);
  fb_mat33_mulT_vec3(ph, R, state->u);
  for (int i = 0; i < 3; i++) {
    ph[i] *= body->mass;
  }
  fb_mat33_mulT_vec3(ph + 3, R, state->L);
  fbi_copy(p, state->pi, n);
  fbi_copy(p + n, ph + first, 6 - first);
}

/* f = (rates of x, outputs, momenta of the linear model) with x_j, or from `states` on an input, increased by h. */
static fb_status fbi_body_response(fb_real *f, const fbi_subject *s, int j, fb_real h)
{
  fb_analyse_work *const work = s->work;
  const fb_body *const body = s->body;
  const int n = body->n, first = fbi_first_free(body->base), n_free = 6 - first, states = 2 * (n + n_free);
  fb_real frame[12];
  fb_status status = FB_OK;

  /* State and input, then rates and motion */
  work->moved = *s->state;
  work->input = *s->input;
  if (j < states) {
    status = fbi_linear_move(&work->moved, s, j, h);
  } else {
    fbi_port_drive(&work->input, &s->desc->in[j - states], h);
  }
  status = status ? status : fb_body_rates_eval(body, &work->rate, &work->moved, &work->input);
  status = status ? status : fb_body_motion_eval(body, &work->motion, &work->moved, &work->input);
  if (status != FB_OK) {
    return status;
  }

  /* Rates of x, outputs, momenta */
  fbi_copy(f, work->rate.q, n);
  fbi_copy(f + n, work->rate.pi, n);
  fbi_linear_frame(frame, work, s->state, body->mass);
  fbi_copy(f + 2 * n, frame + first, n_free);
  fbi_copy(f + 2 * n + n_free, frame + 6 + first, n_free);
  fbi_linear_momenta(f + states + s->desc->n_out, body, &work->moved);
  for (int k = 0; k < s->desc->n_out && status == FB_OK; k++) {
    status = fbi_port_read(f + states + k, body, &work->moved, &work->motion, &s->desc->out[k]);
  }
  return status;
}

#if FB_WITH_SYSTEM
/* ---- residual and response of a system */

static fb_status fbi_system_analyse_check(fb_system_analyse_work *work, const fb_system *system, const fb_body *body,
                                          const fb_system_state *state, const fb_system_input *input)
{
  fb_status status;
  FBI_REQUIRE(system && body && work && state, FB_ERR_NULL);
  work->system.joint = -1; /* no joint has failed yet */
  if (system->method == FB_METHOD_MULTIPLIERS || (input && input->rows)) {
    return FB_ERR_UNSUPPORTED;
  }
  status = fbi_system_input_check(system, body, input);
  return status ? status : fbi_system_range(system, body, state);
}

/* Characteristic length of a system [m], the scale of sliding coordinates: the largest radius of gyration of a body or
   offset of a joint; 1 m where all are zero. */
static fb_real fbi_system_size(const fb_system *system, const fb_body *body)
{
  fb_real size = FB_R(0.0);
  for (int k = 0; k < system->n_body; k++) {
    const fb_body *const model = fbi_model(system, body, k);
    size = fbi_larger(size, model->mass > FB_R(0.0) ? model->gyration : FB_R(0.0));
    size = fbi_larger(size, fbi_vec3_norm(system->joint[k].position));
    size = fbi_larger(size, fbi_vec3_norm(system->joint[k].child_position));
  }
  return size > FB_R(0.0) ? size : FB_R(1.0);
}

/* Lists the coordinates of the linear model, free axes of the joints and then modes, with their finite-difference
   steps. The trim leaves the coordinates of free joints out. */
static fb_status fbi_coordinates_find(fb_system_analyse_work *work, const fb_system *system, const fb_body *body,
                                      const fb_system_state *state, int trim)
{
  const fb_real size = fbi_system_size(system, body);
  work->n = 0;
  for (int mode = 0; mode < 2; mode++) {
    for (int k = 0; k < system->n_body; k++) {
      const fb_joint *const joint = &system->joint[k];
      const fb_body *const model = fbi_model(system, body, k);
      for (int i = 0; i < (mode ? model->n : joint->n_axis); i++) {
        const fbi_coordinate c = {k, mode, i};
        const int free = joint->kind == FB_JOINT_FREE, slides = fbi_axis_slides(joint, i) || (free && i < 3);
        if (!mode && (state->mode[k][free ? 0 : i] != FB_AXIS_FREE || (free && trim))) {
          continue;
        }
        FBI_REQUIRE(work->n < FB_MAX_LINEAR / 2, FB_ERR_CAPACITY);
        work->coordinate[work->n] = c;
        work->size[work->n] = mode ? fbi_difference_step(model, i) : FBI_DIFFERENCE * (slides ? size : FB_R(1.0));
        work->n++;
      }
    }
  }
  return FB_OK;
}

static void fbi_coordinate_move(fb_system_state *state, const fb_system *system, const fbi_coordinate *c, fb_real h)
{
  const fb_joint_kind kind = system->joint[c->body].kind;
  fb_link_state *const x = &state->link[c->body];
  if (c->mode) {
    x->q[c->i] += h;
  } else if (fbi_is_ball(kind)) {
    fbi_frame_move(x->x, x->quat, kind == FB_JOINT_FREE ? c->i : 3 + c->i, h);
  } else {
    x->x[c->i] += h;
  }
}

/* Velocities of all bodies per unit speed of one coordinate. The poses of the bodies are known. */
static void fbi_unit_speeds(const fbi_subject *s, const fbi_coordinate *c)
{
  fb_system_work *const w = &s->system_work->system;
  for (int k = 0; k < s->system->n_body; k++) {
    fbi_vec6_zero(w->link[k].u);
    fbi_zero(w->link[k].q_dot, fbi_model(s->system, s->body, k)->n);
  }
  (c->mode ? w->link[c->body].q_dot : w->link[c->body].u)[c->i] = FB_R(1.0);
  fbi_speeds_out(w, s->system, s->body);
}

/* Momenta along the axes of the coordinate's joint per unit speed of the coordinate; those of all bodies are left in
   `moved`. */
static void fbi_unit_momenta(fb_real p[6], const fbi_subject *s, const fbi_coordinate *c)
{
  fb_system_work *const w = &s->system_work->system;
  fbi_unit_speeds(s, c);
  fbi_momenta_fill(&s->system_work->moved, w, s->system, s->body);
  fbi_joint_momenta(p, &w->link[c->body], &s->system->joint[c->body], &s->system_work->moved.link[c->body]);
}

/* ---- loops: dependent coordinates */

/* Evaluates the poses of the bodies and fills Z = (Jacobian of the loop constraints, their violation). row_size: scale
   of a row, by which its elements are judged. */
static fb_status fbi_loops_rows(const fbi_subject *s, const fb_system_state *state)
{
  fb_system_analyse_work *const work = s->system_work;
  fb_system_work *const w = &work->system;
  const int n = work->n;
  fb_status status = FB_OK;

  /* Constraint rows and their violation */
  fbi_system_enter(w, s->system);
  fbi_links_place(w, s->system, s->body, state, state);
  if (s->system->n_loop > 0) {
    status = fbi_rows_fill(w, s->system, s->body, state, s->system_input);
  }
  for (int r = 0; r < w->n_row && status == FB_OK; r++) {
    work->Z[r * (n + 1) + n] = w->row[r].r.holonomic ? w->row[r].r.value : FB_R(0.0);
    work->row_size[r] = FB_R(0.0);
    w->order[r] = r;
  }

  /* Jacobian, column by column */
  for (int j = 0; j < n && w->n_row > 0 && status == FB_OK; j++) {
    fbi_unit_speeds(s, &work->coordinate[j]);
    fbi_ends_move(w, s->system, s->body);
    for (int r = 0; r < w->n_row; r++) {
      work->Z[r * (n + 1) + j] = fbi_row_eval(&w->row[r], w);
      work->row_size[r] = fbi_larger(work->row_size[r], fbi_row_size(&w->row[r], w) * work->size[j]);
    }
  }
  return status;
}

/* Pivot: the largest scaled element of rows k and later, over all columns (choose) or in the column of the k-th
   dependent coordinate. */
static fb_real fbi_loops_pivot(int *row, int *column, const fb_system_analyse_work *work, int k, int choose)
{
  const int n = work->n;
  fb_real best = FB_R(0.0);
  for (int r = k; r < work->system.n_row; r++) {
    for (int j = choose ? 0 : work->dependent[k]; j < (choose ? n : work->dependent[k] + 1); j++) {
      const fb_real size = FB_FABS(work->Z[r * (n + 1) + j]) * work->size[j];
      if (size > best * work->row_size[r]) {
        best = size / work->row_size[r];
        *row = r;
        *column = j;
      }
    }
  }
  return best;
}

/* [E12.11] Coordinate partitioning by Gauss-Jordan elimination of Z: coordinate dependent[k] changes by -Z_kj per unit
   of independent coordinate j, and -Z_kn closes the loops. choose: full pivoting selects the dependent coordinates;
   redundant rows are dropped. Otherwise the selection of before is kept.
   Source: [GV] 3.4.  Cost: rows^2 n.  Fails: FB_ERR_SINGULAR, a dependent coordinate is no longer determined by the
   others; work names the joint of a row that is left.
   Test: rods_in_a_loop_swing_as_one_pendulum, held_tips_take_a_mode_away. */
static fb_status fbi_loops_reduce(fb_system_analyse_work *work, int choose)
{
  const int n = work->n, rows = work->system.n_row, width = n + 1;
  const int count = !choose ? work->n_dependent : rows < n ? rows : n;
  for (int k = 0; k < count; k++) {
    int row = k, column = 0;
    fb_real scale;

    /* Pivot; without one the rows that are left are redundant (choose), or the selection fails */
    if (!(fbi_loops_pivot(&row, &column, work, k, choose) > (FB_SINGLE ? FB_R(1e-3) : FB_R(1e-8)))) {
      work->n_dependent = choose ? k : work->n_dependent;
      work->system.joint = choose ? work->system.joint : work->system.row[work->system.order[k]].joint;
      return choose ? FB_OK : FB_ERR_SINGULAR;
    }
    work->dependent[k] = column;
    work->n_dependent = choose ? k + 1 : work->n_dependent;

    /* Its row becomes row k, scaled to pivot 1, and eliminates the column from all others */
    scale = FB_R(1.0) / work->Z[row * width + column];
    for (int j = 0; j < width; j++) {
      const fb_real element = work->Z[row * width + j];
      work->Z[row * width + j] = work->Z[k * width + j];
      work->Z[k * width + j] = scale * element;
    }
    work->row_size[row] = work->row_size[k];
    work->system.order[row] = work->system.order[k];
    for (int r = 0; r < rows; r++) {
      if (r != k) {
        fbi_row_sub(work->Z + r * width, work->Z[r * width + column], work->Z + k * width, width);
      }
    }
  }
  return FB_OK;
}

/* Selects the dependent coordinates and lists the independent ones in their order. */
static fb_status fbi_loops_open(const fbi_subject *s, const fb_system_state *state)
{
  fb_system_analyse_work *const work = s->system_work;
  fb_status status = fbi_loops_rows(s, state);
  work->n_dependent = work->n_independent = 0;
  status = status ? status : fbi_loops_reduce(work, 1);
  for (int j = 0; j < work->n; j++) {
    int depends = 0;
    for (int k = 0; k < work->n_dependent; k++) {
      depends |= work->dependent[k] == j;
    }
    if (!depends) {
      work->common.step[work->n_independent] = work->size[j];
      work->independent[work->n_independent++] = j;
    }
  }
  return status;
}

/* FB_ERR_CONTRADICTION: a loop is open at the present poses; redundant rows are checked, too. */
static fb_status fbi_loops_check(fb_system_analyse_work *work)
{
  for (int r = 0; r < work->system.n_row; r++) {
    const fb_real miss = FB_FABS(work->Z[r * (work->n + 1) + work->n]);
    if (work->row_size[r] > FB_R(0.0) && !(miss <= (FB_SINGLE ? FB_R(1e-2) : FB_R(1e-6)) * work->row_size[r])) {
      work->system.joint = work->system.row[r].joint;
      return FB_ERR_CONTRADICTION;
    }
  }
  return FB_OK;
}

/* Closes the loops of a state by Newton's method on its dependent coordinates; poses and Z of the work are then those
   of the closed loops. */
static fb_status fbi_loops_shut(const fbi_subject *s, fb_system_state *state)
{
  fb_system_analyse_work *const work = s->system_work;
  const int passes = work->n_dependent > 0 ? 8 : 0;
  fb_status status = FB_OK;
  for (int pass = 0; pass <= passes && status == FB_OK; pass++) {
    status = fbi_loops_rows(s, state);
    status = status || pass < passes ? status : fbi_loops_check(work);
    status = status ? status : fbi_loops_reduce(work, 0);
    for (int k = 0; k < work->n_dependent && pass < passes && status == FB_OK; k++) {
      fbi_coordinate_move(state, s->system, &work->coordinate[work->dependent[k]],
                          -work->Z[k * (work->n + 1) + work->n]);
    }
  }
  return status;
}

/* Forces or momenta x of all coordinates reduced to independent coordinate j: x_j - sum_k Z_kj x_dependent(k). */
static fb_real fbi_loops_reduced(const fb_system_analyse_work *work, const fb_real *x, int j)
{
  const int at = work->independent[j];
  fb_real sum = x[at];
  for (int k = 0; k < work->n_dependent; k++) {
    sum -= work->Z[k * (work->n + 1) + at] * x[work->dependent[k]];
  }
  return sum;
}

/* Rates of the coordinates z of a joint and of the momenta p along its axes, as defined for fb_linear. */
static void fbi_joint_rates(fb_real z[6], fb_real p[6], const fbi_subject *s, int k)
{
  const fb_system_analyse_work *const work = s->system_work;
  const fbi_link_work *const L = &work->system.link[k];
  const fb_joint *const joint = &s->system->joint[k];
  const fb_link_state *const x = &work->moved.link[k], *const x0 = &s->system_state->link[k];
  const fb_link_state *const rate = &work->rate.link[k];
  if (joint->kind == FB_JOINT_FREE) {
    fbi_shift_rate(z, x0->quat, x0->x, work->steady[k], x->x, rate->x);
    fbi_turn_rate(z + 3, x0->quat, work->steady[k] + 3, x->quat, L->V + 3);
    fbi_turned_rate(p, L->k.R, L->V + 3, x->p, rate->p);
    fbi_turned_rate(p + 3, L->k.R, L->V + 3, x->p + 3, rate->p + 3);
  } else if (joint->kind == FB_JOINT_SPHERICAL) {
    fb_real h[3];
    fbi_turn_rate(z, x0->quat, work->steady[k], x->quat, L->u);
    fbi_turned_rate(h, L->k.R, L->V + 3, x->p, rate->p);
    fb_mat33_mulT_vec3(p, joint->child_axes, h);
  } else {
    fbi_copy(z, rate->x, joint->n_axis);
    fbi_copy(p, rate->p, joint->n_axis);
  }
}

/* Rates of the independent coordinates, then of their momenta, from the rates of the state `moved`. */
static void fbi_system_linear_rates(fb_real *f, const fbi_subject *s)
{
  fb_system_analyse_work *const work = s->system_work;
  fb_real z[6], p[6];
  for (int j = 0, at = -1; j < work->n; j++) {
    const fbi_coordinate *const c = &work->coordinate[j];
    if (!c->mode && c->body != at) {
      at = c->body;
      fbi_joint_rates(z, p, s, at);
    }
    work->z_dot[j] = c->mode ? work->rate.link[c->body].q[c->i] : z[c->i];
    work->p_dot[j] = c->mode ? work->rate.link[c->body].pi[c->i] : p[c->i];
  }
  for (int j = 0; j < work->n_independent; j++) {
    f[j] = work->z_dot[work->independent[j]];
    f[work->n_independent + j] = fbi_loops_reduced(work, work->p_dot, j);
  }
}

/* Is it a free joint whose motion is not prescribed? */
static int fbi_is_afloat(const fb_system *system, const fb_system_state *state, int k)
{
  return system->joint[k].kind == FB_JOINT_FREE && state->mode[k][0] == FB_AXIS_FREE;
}

/* Steady speeds of the free joints: the tree on each spins freely at the rate that the input gives. The poses of the
   bodies are known. */
static fb_status fbi_roots_spin(const fbi_subject *s)
{
  fb_system_analyse_work *const work = s->system_work;
  fb_status status = FB_OK;
  for (int k = 0; k < s->system->n_body && status == FB_OK && s->system_input; k++) {
    const fb_real *const wanted = s->system_input->drive[k].rate + 3;
    fb_real momenta[24];
    if (!fbi_is_afloat(s->system, &work->moved, k) || fb_vec3_dot(wanted, wanted) == FB_R(0.0)) {
      continue;
    }
    for (int i = 0; i < 4; i++) { /* w = e_1, e_2, e_3; v = e_1, whose momentum is the mass */
      const fbi_coordinate c = {k, 0, (3 + i) % 6};
      fbi_unit_momenta(momenta + 6 * i, s, &c);
    }
    status = fbi_free_spin(work->rest[k].speed, momenta, momenta[18], wanted);
  }
  return status;
}

/* Are the free joints of the trimmed state in equilibrium, too? FB_ERR_UNREST where force or torque accelerate one. */
static fb_status fbi_roots_rest(const fbi_subject *s)
{
  fb_system_analyse_work *const work = s->system_work;
  const fb_real length = fbi_system_size(s->system, s->body);
  fb_real torque = FB_R(0.0), w[3];
  for (int k = 0; k < s->system->n_body; k++) {
    const fb_real *const fg = work->system.link[k].k.fg;
    torque += fbi_vec3_norm(fg + 3) + length * fbi_vec3_norm(fg);
  }
  for (int k = 0; k < s->system->n_body; k++) {
    const fbi_link_work *const L = &work->system.link[k];
    const fb_real *const rate = work->rate.link[k].p;
    fb_mat33_mul_vec3(w, L->k.R, L->V + 3);
    if (fbi_is_afloat(s->system, &work->moved, k) &&
        !fbi_is_balanced(rate, rate + 3, work->moved.link[k].p + 3, w, length, torque)) {
      work->system.joint = k;
      return FB_ERR_UNREST;
    }
  }
  return FB_OK;
}

/* Residual of the trim: rates of the momenta with independent coordinate j increased by h, at zero speeds but for
   prescribed axes and free spins. */
static fb_status fbi_system_residual(fb_real *f, const fbi_subject *s, int j, fb_real h)
{
  fb_system_analyse_work *const work = s->system_work;
  fb_system_work *const w = &work->system;
  fb_status status;
  work->moved = *s->system_state;
  if (work->n_independent > 0) {
    fbi_coordinate_move(&work->moved, s->system, &work->coordinate[work->independent[j]], h);
  }
  status = fbi_loops_shut(s, &work->moved);
  status = status ? status : fbi_roots_spin(s);
  fbi_speeds_take(w, s->system, s->body, &work->moved, work->rest, s->system_input);
  fbi_momenta_fill(&work->moved, w, s->system, s->body);
  status = status ? status : fb_system_rates_eval(s->system, s->body, w, &work->rate, &work->moved, s->system_input);
  if (status == FB_OK) {
    fbi_system_linear_rates(f, s);
    fbi_copy(f, f + work->n_independent, work->n_independent);
  }
  return status;
}

/* Momenta of the independent coordinates (out) and of all (p); the poses of the bodies are known. */
static void fbi_system_momenta(fb_real *out, fb_real *p, const fbi_subject *s, const fb_system_state *state)
{
  const fb_system_analyse_work *const work = s->system_work;
  for (int j = 0; j < work->n; j++) {
    const fbi_coordinate *const c = &work->coordinate[j];
    const fb_link_state *const x = &state->link[c->body];
    fb_real own[6];
    fbi_joint_momenta(own, &work->system.link[c->body], &s->system->joint[c->body], x);
    p[j] = c->mode ? x->pi[c->i] : own[c->i];
  }
  for (int j = 0; j < work->n_independent; j++) {
    out[j] = fbi_loops_reduced(work, p, j);
  }
}

/* Sets the momenta of the state `moved`, whose loops are closed, along the axes of the joints: the steady ones, with h
   added to that of independent coordinate j. In loops the momenta of dependent coordinates are set to zero, since the
   reduced momenta of the independent ones contain them; fbi_loops_reduced gives the rates. */
static void fbi_momenta_keep(const fbi_subject *s, int j, fb_real h)
{
  fb_system_analyse_work *const work = s->system_work;
  fb_real p[FB_MAX_BODIES][6];
  for (int k = 0; k < s->system->n_body; k++) {
    fbi_vec6_zero(p[k]);
    fbi_zero(work->moved.link[k].pi, fbi_model(s->system, s->body, k)->n);
  }
  for (int i = 0; i < work->n_independent; i++) {
    const fbi_coordinate *const c = &work->coordinate[work->independent[i]];
    (c->mode ? work->moved.link[c->body].pi : p[c->body])[c->i] = work->momenta[i] + (j == i ? h : FB_R(0.0));
  }
  for (int k = 0; k < s->system->n_body; k++) {
    fbi_joint_momenta_set(&work->moved.link[k], &work->system.link[k], &s->system->joint[k], p[k]);
  }
}

/* Does coordinate j belong to a free joint? Momenta in axes of the child do not depend on it. */
static int fbi_is_pose(const fbi_subject *s, int j)
{
  const fbi_coordinate *const c = &s->system_work->coordinate[s->system_work->independent[j]];
  return !c->mode && s->system->joint[c->body].kind == FB_JOINT_FREE;
}

/* State `moved` with element j of x increased by h (if j is not an input). In trees, with a coordinate the speeds stay
   constant and the momenta change (E12.12); otherwise the momenta keep their components along the axes of the
   joints. */
static fb_status fbi_system_linear_move(const fbi_subject *s, int j, fb_real h)
{
  fb_system_analyse_work *const work = s->system_work;
  const int n = work->n_independent;
  fb_status status;
  if (j < n) {
    fbi_coordinate_move(&work->moved, s->system, &work->coordinate[work->independent[j]], h);
  }
  status = fbi_loops_shut(s, &work->moved);
  if (j < n && s->system->n_loop == 0 && !fbi_is_pose(s, j)) {
    fbi_speeds_take(&work->system, s->system, s->body, &work->moved, work->rest, s->system_input);
    fbi_momenta_fill(&work->moved, &work->system, s->system, s->body);
  } else {
    fbi_momenta_keep(s, j - n, h);
  }
  fbi_system_momenta(work->p_moved, work->p_dot, s, &work->moved);
  return status;
}

static void fbi_system_port_drive(fb_system_input *input, const fb_port *port, fb_real h)
{
  fb_drive *const drive = &input->drive[port->body];
  if (port->kind == FB_PORT_BASE_VELOCITY || port->kind == FB_PORT_BASE_RATE) {
    drive->rate[(port->kind == FB_PORT_BASE_VELOCITY ? 0 : 3) + port->axis] += h;
  } else if (port->kind == FB_PORT_DRIVE) {
    drive->torque[port->axis] += h;
  } else {
    input->load[input->n_load].body = port->body;
    fbi_port_load(&input->load[input->n_load].load, port, h);
    input->n_load++;
  }
}

static fb_status fbi_system_port_read(fb_real *y, const fbi_subject *s, const fb_port *port)
{
  const fb_system_motion *const motion = &s->system_work->motion;
  const int k = port->body;
  if (port->kind == FB_PORT_COORDINATE || port->kind == FB_PORT_SPEED) {
    *y = (port->kind == FB_PORT_SPEED ? motion->joint[k].speed : motion->joint[k].value)[port->axis];
    return FB_OK;
  }
  return fbi_port_read(y, fbi_model(s->system, s->body, k), &motion->pose[k], &motion->motion[k], port);
}

/* f = (rates of x, outputs, momenta of the linear model) with x_j, or from `states` on an input, increased by h. */
static fb_status fbi_system_response(fb_real *f, const fbi_subject *s, int j, fb_real h)
{
  fb_system_analyse_work *const work = s->system_work;
  const int states = 2 * work->n_independent;
  fb_status status;

  /* State and input, then rates */
  work->moved = *s->system_state;
  memset(&work->input, 0, sizeof work->input);
  if (s->system_input) {
    work->input = *s->system_input;
  }
  if (j >= states) {
    fbi_system_port_drive(&work->input, &s->desc->in[j - states], h);
  }
  status = fbi_system_linear_move(s, j, h);
  status = status ? status
                  : fb_system_rates_eval(s->system, s->body, &work->system, &work->rate, &work->moved, &work->input);
  if (status != FB_OK) {
    return status;
  }

  /* Rates of x, momenta, outputs */
  fbi_system_linear_rates(f, s);
  fbi_copy(f + states + s->desc->n_out, work->p_moved, work->n_independent);
  if (s->desc->n_out > 0) {
    status = fb_system_motion_eval(s->system, s->body, &work->system, &work->motion, &work->moved, &work->input);
  }
  for (int k = 0; k < s->desc->n_out && status == FB_OK; k++) {
    status = fbi_system_port_read(f + states + k, s, &s->desc->out[k]);
  }
  return status;
}
#endif

/* ---- derivatives and Newton's method, of bodies and systems */

static fb_status fbi_subject_eval(fb_real *f, const fbi_subject *s, int j, fb_real h)
{
#if FB_WITH_SYSTEM
  if (s->system) {
    return s->desc ? fbi_system_response(f, s, j, h) : fbi_system_residual(f, s, j, h);
  }
#endif
  return s->desc ? fbi_body_response(f, s, j, h) : fbi_body_residual(f, s, j, h);
}

/* Corrects unknown j of the trim by h. */
static fb_status fbi_subject_move(const fbi_subject *s, int j, fb_real h)
{
#if FB_WITH_SYSTEM
  if (s->system) {
    fb_system_analyse_work *const work = s->system_work;
    fbi_coordinate_move(&work->state, s->system, &work->coordinate[work->independent[j]], h);
    return fbi_loops_shut(s, &work->state);
  }
#endif
  s->work->state.q[j] += h;
  return FB_OK;
}

/* Column j of the Jacobian of f by central differences with the values at -2, -1, 1, 2 steps h; exact for polynomials
   of degree 4. */
static fb_status fbi_difference(fbi_analysis *work, const fbi_subject *s, int j, fb_real h, int count)
{
  static const fb_real weight[4] = {FB_R(1.0) / FB_R(12.0), -FB_R(2.0) / FB_R(3.0), FB_R(2.0) / FB_R(3.0),
                                    -FB_R(1.0) / FB_R(12.0)};
  static const int at[4] = {-2, -1, 1, 2};
  fb_status status = FB_OK;
  fbi_zero(work->column, count);
  for (int k = 0; k < 4 && status == FB_OK; k++) {
    status = fbi_subject_eval(work->f, s, j, (fb_real)at[k] * h);
    for (int i = 0; i < count && status == FB_OK; i++) {
      work->column[i] += weight[k] / h * work->f[i];
    }
  }
  return status;
}

/* Newton's method for f = 0 in n unknowns. change: the last correction relative to the size of the body, or in radians;
   the iteration ends when it is round-off. */
static fb_status fbi_trim_newton(fb_real *change, fbi_analysis *work, const fbi_subject *s, int n)
{
  fb_status status = FB_OK;
  *change = FB_R(1.0);
  for (int step = 0; step < 40 && *change > FB_R(64.0) * FB_EPSILON && status == FB_OK; step++) {
    /* Jacobian by differences, and the residual */
    for (int j = 0; j < n && status == FB_OK; j++) {
      status = fbi_difference(work, s, j, work->step[j], n);
      for (int i = 0; i < n; i++) {
        work->A[i * n + j] = work->column[i];
      }
    }
    status = status ? status : fbi_subject_eval(work->f, s, 0, FB_R(0.0));

    /* Correction */
    status = status || n == 0 ? status : fb_lu_factor(work->A, work->perm, work->scale, n);
    *change = FB_R(0.0);
    if (status == FB_OK) {
      fb_lu_solve(work->column, work->A, work->perm, work->f, n);
    }
    for (int j = 0; j < n && status == FB_OK; j++) {
      *change = fbi_larger(*change, FB_FABS(work->column[j]) * FBI_DIFFERENCE / work->step[j]);
      status = fbi_subject_move(s, j, -work->column[j]);
    }
  }
  return status ? status : fbi_subject_eval(work->f, s, 0, FB_R(0.0));
}

static int fbi_is_settled(fb_real change)
{
  return !(change > (FB_SINGLE ? FB_R(1e-4) : FB_R(1e-9)));
}

/* desc: NULL for a trim */
static fbi_subject fbi_subject_body(const fb_body *body, fb_analyse_work *work, const fb_state *state,
                                    const fb_input *input, const fb_linear_desc *desc)
{
  fbi_subject s;
  memset(&s, 0, sizeof s);
  s.body = body;
  s.desc = desc;
  s.work = work;
  s.state = state;
  s.input = input;
  return s;
}

/* [E12.1] Steady state by Newton's method: pi_dot(q) = 0 at q_dot = 0, the Jacobian by differences.
   Source: definition.  Cost: 4 n evaluations and an LU factorization per iteration.  Fails: see the header.
   Test: spectrum_of_a_spinning_oscillator_is_closed_form, bases_that_are_pushed_have_no_state_of_rest. */
FB_DEF fb_status fb_body_trim(const fb_body *body, fb_state *state, fb_analyse_work *work, const fb_input *input)
{
  fbi_subject s;
  fb_real change;
  fb_status status = fbi_analyse_check(body, state, input);
  FBI_REQUIRE(work, FB_ERR_NULL);
  if (status != FB_OK) {
    return status;
  }

  /* Newton's method from the given state */
  s = fbi_subject_body(body, work, &work->state, input, NULL);
  work->state = *state;
  for (int a = 0; a < body->n; a++) {
    work->common.step[a] = fbi_difference_step(body, a);
  }
  status = fbi_trim_newton(&change, &work->common, &s, body->n);
  status = status ? status : fb_state_check(body, &work->moved);
  if (status == FB_OK && !fbi_is_settled(change)) {
    status = FB_ERR_CONVERGENCE;
  }

  /* Equilibrium of the base; the momenta of a prescribed one as of any state */
  status = status ? status : fbi_body_rest(work, body, input);
  if (status == FB_OK && body->base == FB_BASE_PRESCRIBED) {
    status = fb_state_from_velocity(body, &work->moved, input->v, input->w, NULL);
  }
  if (status == FB_OK) {
    *state = work->moved;
  }
  return status;
}

#if FB_WITH_SYSTEM
static fbi_subject fbi_subject_system(const fb_system *system, const fb_body *body, fb_system_analyse_work *work,
                                      const fb_system_state *state, const fb_system_input *input,
                                      const fb_linear_desc *desc)
{
  const fbi_subject s = {body, desc, NULL, NULL, NULL, system, work, state, input};
  return s;
}

/* [E12.8] Relative equilibrium of a system by Newton's method: the momenta of modes, and of joints along their axes,
   are constant while prescribed axes move at their rates, free joints spin freely and all other speeds are zero.
   Source: definition.  Cost: 8 n evaluations and an LU factorization per iteration.  Fails: see the header.
   Test: hinged_blades_flap_and_lag_in_closed_form, blades_cone_under_a_moment,
   bases_that_are_pushed_have_no_state_of_rest. */
FB_DEF fb_status fb_system_trim(const fb_system *system, const fb_body *body, fb_system_state *state,
                                fb_system_analyse_work *work, const fb_system_input *input)
{
  fbi_subject s;
  fb_real change;
  fb_status status = fbi_system_analyse_check(work, system, body, state, input);
  status = status ? status : fbi_coordinates_find(work, system, body, state, 1);
  if (status != FB_OK) {
    return status;
  }

  /* Initial state: prescribed axes at their rates; momenta of the trees relative to frames at rest, in which alone
     those of a steady rotation are constant */
  s = fbi_subject_system(system, body, work, &work->state, input, NULL);
  work->state = *state;
  for (int k = 0; k < system->n_body; k++) {
    fbi_zero(work->state.link[k].u, 3);
    fbi_zero(work->state.link[k].lost_u, 3);
  }
  memset(work->steady, 0, sizeof work->steady);
  memset(work->rest, 0, sizeof work->rest);
  fbi_system_enter(&work->system, system);
  fbi_prescribe(&work->state, system, &work->system, &work->state, input);

  /* Newton's method with closed loops */
  status = fbi_loops_open(&s, &work->state);
  status = status ? status : fbi_loops_shut(&s, &work->state);
  status = status ? status : fbi_trim_newton(&change, &work->common, &s, work->n_independent);
  status = status ? status : fbi_system_range(system, body, &work->moved);
  if (status == FB_OK && !fbi_is_settled(change)) {
    status = FB_ERR_CONVERGENCE;
  }

  /* Equilibrium of the free joints */
  status = status ? status : fbi_roots_rest(&s);
  if (status == FB_OK) {
    *state = work->moved;
  }
  return status;
}
#endif

#if FB_WITH_EXACT
/* ---- paths of steady states */

static void fbi_exact_loads_take(fbi_exact_loads *to, const fb_exact_work *work, const fb_exact *m)
{
  fbi_copy(to->line, work->line, 6 * m->n);
  fbi_copy(to->line_dead, work->line_dead, 6 * m->n);
  fbi_copy(to->offset, work->offset, 6 * m->n);
  fbi_copy(to->follower, work->follower, 6 * (m->n + 1));
  fbi_copy(to->dead, work->dead, 6 * (m->n + 1));
}

static void fbi_exact_sum(fb_real *x, const fb_real *a, fb_real factor, const fb_real *b, int n)
{
  for (int i = 0; i < n; i++) {
    x[i] = a[i] + factor * b[i];
  }
}

/* Residuals under the constant loads and `factor` times the varied ones. */
static void fbi_exact_path_residual(fb_exact_path_work *w, const fb_exact *m, fb_real factor)
{
  const fbi_exact_loads *const a = &w->constant, *const b = &w->varied;
  fb_exact_work *const work = &w->exact;
  fbi_exact_sum(work->line, a->line, factor, b->line, 6 * m->n);
  fbi_exact_sum(work->line_dead, a->line_dead, factor, b->line_dead, 6 * m->n);
  fbi_exact_sum(work->offset, a->offset, factor, b->offset, 6 * m->n);
  fbi_exact_sum(work->follower, a->follower, factor, b->follower, 6 * (m->n + 1));
  fbi_exact_sum(work->dead, a->dead, factor, b->dead, 6 * (m->n + 1));
  fbi_exact_nodes_eval(work, m);
  fbi_exact_residual(work, m);
}

/* Loads of both inputs, and the steady motion of the base. */
static void fbi_exact_path_begin(fb_exact_path_work *w, const fb_exact *m, const fb_exact_state *state,
                                 const fb_exact_input *constant, const fb_exact_input *varied)
{
  const fbi_exact_motion steady = {0, 0, 0, 0, FB_R(1.0), FB_R(0.0)};
  fb_exact_work *const work = &w->exact;
  int dead;
  work->motion = steady;
  fbi_exact_input_take(work, m, state->base_quat, varied, FB_R(1.0), FB_R(0.0));
  fbi_exact_loads_take(&w->varied, work, m);
  dead = work->motion.dead;
  fbi_exact_input_take(work, m, state->base_quat, constant, FB_R(1.0), FB_R(0.0));
  fbi_exact_loads_take(&w->constant, work, m);
  work->motion.dead |= dead;
  work->motion.inertia = !fbi_is_zero(work->twist + 3, 3);
  fbi_zero(work->momentum, 6 * m->n);
  fbi_zero(work->lump, 6 * m->n_lump);
}

/* Newton correction at a constant load factor, in w->dd and w->ds, and the tangent, the change per unit of the factor,
   in dd and ds of w->exact. */
static fb_status fbi_exact_path_solve(fb_exact_path_work *w, const fb_exact *m, fb_real factor)
{
  fb_exact_work *const work = &w->exact;
  fb_status status;
  fbi_exact_path_residual(w, m, factor + FB_R(1.0));
  fbi_copy(w->B, work->B, 6 * (m->n + 1));
  fbi_copy(w->c, work->c, 6 * m->n);
  fbi_exact_path_residual(w, m, factor);
  fbi_exact_want(work, m, FB_R(0.0), 1);
  status = fbi_exact_factor(work, m);
  if (status != FB_OK) {
    return status;
  }
  fbi_exact_solve(work, m);
  fbi_copy(w->dd, work->dd, 6 * (m->n + 1));
  fbi_copy(w->ds, work->ds, 6 * m->n);
  fbi_exact_sum(work->B, w->B, -FB_R(1.0), work->B, 6 * (m->n + 1));
  fbi_exact_sum(work->c, w->c, -FB_R(1.0), work->c, 6 * m->n);
  fbi_zero(work->want, 6 * (m->n + 1));
  fbi_exact_solve(work, m);
  return FB_OK;
}

/* [E12.17] Arc-length continuation of steady states x(l) in the load factor l; x are the displacements and rotations of
   the nodes. The unit tangent is t = (x_l, 1) l_s, (x_l.x_l)/(n + 1) l_s^2 + l_s^2 = 1. The first correction has the
   length `arc` along it, the others are normal to it (Riks' normal plane): with dx the correction at constant l,
   dl = (arc or 0 - t.dx)/(t.x_l + t_l). The tangents at both ends differ by less than 60 degrees.
   Source: [RI], [CF].
   Cost: E10.10 and two solutions per iteration.  Fails: 12 iterations; neighboring nodes rotated by more than a radian
   against each other in one.  Test: arches_snap_at_their_limit_load, a_stiff_truss_snaps_in_closed_form. */
static fb_status fbi_exact_path_try(fb_exact_path_work *w, const fb_exact *m, fb_exact_path *path, fb_real arc)
{
  fb_exact_work *const work = &w->exact;
  const int n = 6 * (m->n + 1);
  const fb_real part = FB_R(1.0) / (fb_real)(m->n + 1);
  fb_real change = FB_R(1.0), rise = path->rise, slope = FB_R(1.0), size, cosine;
  fb_status status = FB_OK;
  for (int it = 0; it < 12 && status == FB_OK && change > FBI_EXACT_TOLERANCE; it++) {
    fb_real more;

    /* Correction dx at constant l, tangent x_l */
    status = fbi_exact_path_solve(w, m, path->factor);
    path->iterations++;
    if (status != FB_OK) {
      return status;
    }

    /* Unit tangent at the start, in the sense of the previous step */
    size = FB_SQRT(part * fbi_dot(work->dd, work->dd, n) + FB_R(1.0));
    if (it == 0) {
      cosine = part * fbi_dot(path->ahead, work->dd, n) + path->rise;
      rise = (cosine < FB_R(0.0) ? -FB_R(1.0) : FB_R(1.0)) / size;
      for (int i = 0; i < n; i++) {
        w->ahead[i] = rise * work->dd[i];
      }
    }

    /* dl, and the correction dx + dl x_l; the tangent stays in w->dd */
    slope = part * fbi_dot(w->ahead, work->dd, n) + rise;
    more = ((it == 0 ? arc : FB_R(0.0)) - part * fbi_dot(w->ahead, w->dd, n)) / slope;
    for (int i = 0; i < n; i++) {
      const fb_real tangent = work->dd[i];
      work->dd[i] = w->dd[i] + more * tangent;
      w->dd[i] = tangent;
    }
    fbi_exact_sum(work->ds, w->ds, more, work->ds, 6 * m->n);
    change = fbi_larger(fbi_exact_change(work, m, FB_R(1.0), it > 3 ? FB_EPSILON : FB_R(0.0)),
                        FB_FABS(more) / (FB_R(1.0) + FB_FABS(path->factor)));
    status = fbi_exact_turn_add(work, m, change);
    path->factor += more;
  }
  if (status != FB_OK || change > FBI_EXACT_TOLERANCE) {
    return FB_ERR_CONVERGENCE;
  }

  /* Unit tangent at the end, and its angle to that at the start */
  cosine = slope / size;
  for (int i = 0; i < n; i++) {
    path->ahead[i] = (cosine < FB_R(0.0) ? -FB_R(1.0) : FB_R(1.0)) * w->dd[i] / size;
  }
  path->rise = (cosine < FB_R(0.0) ? -FB_R(1.0) : FB_R(1.0)) / size;
  return FB_FABS(cosine) > FB_R(0.5) ? FB_OK : FB_ERR_CONVERGENCE;
}

FB_DEF fb_status fb_exact_path_step(const fb_exact *m, fb_exact_path *path, fb_exact_state *state,
                                    fb_exact_path_work *w, const fb_exact_input *constant, const fb_exact_input *varied,
                                    fb_real arc)
{
  fb_exact_path next;
  fb_status status;

  /* Check the arguments */
  FBI_REQUIRE(m && path && state && w && varied, FB_ERR_NULL);
  constant = constant ? constant : fbi_exact_no_input(&w->exact);
  status = fb_exact_state_check(m, state);
  status = status ? status : fbi_exact_input_check(m, constant);
  status = status ? status : fbi_exact_input_check(m, varied);
  if (status != FB_OK) {
    return status;
  }
  if (!fbi_is_finite(path->ahead, 6 * (m->n + 1)) || !fbi_is_finite(&path->factor, 1) ||
      !fbi_is_finite(&path->rise, 1)) {
    return FB_ERR_NOT_FINITE;
  }
  if (!(FB_FABS(arc) > FB_R(0.0) && FB_FABS(arc) < FB_HUGE)) {
    return FB_ERR_VALUE;
  }

  /* A step of the length `arc`, halved until it converges */
  fbi_exact_path_begin(w, m, state, constant, varied);
  status = FB_ERR_CONVERGENCE;
  for (int k = 0, iterations = 0; k < 11 && status != FB_OK; k++) {
    next = *path;
    next.iterations = iterations;
    next.arc = arc;
    fbi_exact_pose_take(&w->exact, state, m);
    status = fbi_exact_path_try(w, m, &next, arc);
    iterations = next.iterations;
    arc *= FB_R(0.5);
  }

  /* The state, with the number of its unstable directions */
  if (status == FB_OK) {
    fbi_exact_path_residual(w, m, next.factor);
    fbi_exact_rest(state, &w->exact, m);
    next.unstable = w->exact.unstable;
    *path = next;
  }
  return status;
}
#endif

/* ---------------------------------------------------------------------------------------------------------------
   ANALYSE >>linear: linear models, complex modes, step advice
   (uses config, status, vec3, rotation, solve, body, system, exact, integrate, eigen, trim) */

#if FB_WITH_SYSTEM
/* Order of magnitude of the forces on a body [N]: its weight, and mass times `size` times k [1/s^2]. */
static fb_real fbi_force_size(const fb_body *body, fb_real size, fb_real k)
{
  fb_real a = size * k;
#if FB_WITH_GRAVITY
  a += fbi_has(body->effects, FB_EFFECT_GRAVITY) ? fbi_vec3_norm(body->gravity) : FB_R(0.0);
#endif
  return body->mass * a;
}

/* Magnitude of a load as a force [N], torques divided by the length `size` [m]. */
static fb_real fbi_load_size(const fb_load *load, fb_real size)
{
  return fbi_vec3_norm(load->force) + fbi_vec3_norm(load->torque) / size;
}

/* Finite-difference step of an input; V: velocities of the base; rate [1/s]: characteristic rate of the motion. Rates
   are linear in loads and quadratic in v, w: large steps have no truncation error, small ones round-off beside the
   forces that act already. */
static fb_real fbi_port_step(fb_port_kind kind, int slides, fb_real force, fb_real size, fb_real rate,
                             const fb_real V[6])
{
  const fb_real load = force > FB_R(0.0) ? FB_R(10.0) * force : FB_R(1.0);
  return kind == FB_PORT_BASE_RATE       ? rate + fbi_vec3_norm(V + 3)
         : kind == FB_PORT_BASE_VELOCITY ? size * rate + fbi_vec3_norm(V)
         : slides                        ? load
                                         : load * size;
}

/* Characteristic rate of a coordinate [1/s]: sqrt(k/m) of its stiffness and inertia, plus the rate `steady` of rotation
   and flight. Where both are zero: `other`, or without that 1/s, since rates are then linear in the momenta. */
static fb_real fbi_own_rate(fb_real k, fb_real m, fb_real steady, fb_real other)
{
  const fb_real rate = steady + (k > FB_R(0.0) && m > FB_R(0.0) ? FB_SQRT(k / m) : FB_R(0.0));
  return rate > FB_R(0.0) ? rate : other > FB_R(0.0) ? other : FB_R(1.0);
}

/* ---- input and output channels (ports) */

static int fbi_port_is_input(fb_port_kind kind)
{
  return kind <= FB_PORT_BASE_RATE || kind == FB_PORT_DRIVE;
}

/* Checks a channel; end: the kinds of the subject are below it; base: 1 if the motion of its base is prescribed; room:
   1 if the input has room for one more load. */
static fb_status fbi_port_check(const fb_port *port, int is_input, fb_port_kind end, int base, int n_node, int room)
{
  const int moves_base = port->kind == FB_PORT_BASE_VELOCITY || port->kind == FB_PORT_BASE_RATE;
  if (!fbi_is_choice(port->axis, 2) || !fbi_is_choice((int)port->kind, (int)end - 1) ||
      fbi_port_is_input(port->kind) != is_input || (moves_base && !base)) {
    return FB_ERR_VALUE;
  }
  if (!moves_base && port->kind < FB_PORT_DRIVE && (!fbi_is_choice(port->node, n_node - 1) || (is_input && !room))) {
    return FB_ERR_CAPACITY;
  }
  return FB_OK;
}

/* ---- finite-difference steps and channels of one body */

/* Characteristic length of a body [m]. */
static fb_real fbi_body_size(const fb_body *body)
{
  return body->gyration > FB_R(0.0) ? body->gyration : FB_R(1.0);
}

/* Rate of rotation and flight of the body frame [1/s]. all: the characteristic rate with the slowest mode or, without
   rotation and modes, with loads and weight. */
static fb_real fbi_body_rates_find(fb_real *all, const fb_body *body, const fb_motion *steady, const fb_input *input)
{
  const fb_real size = fbi_body_size(body), rate = fbi_vec3_norm(steady->w) + fbi_vec3_norm(steady->v) / size;
  fb_real force = fbi_force_size(body, size, FB_R(0.0)), slow = FB_R(0.0);
  for (int i = 0; i < input->n_load; i++) {
    force += fbi_load_size(&input->load[i], size);
  }
  for (int a = 0; a < body->n; a++) {
    const fb_real k = body->K.diagonal[a] / body->M.diagonal[a];
    slow = k > FB_R(0.0) && (slow == FB_R(0.0) || k < slow) ? k : slow;
  }
  *all = fbi_own_rate(slow, FB_R(1.0), rate, FB_SQRT(force / (body->mass * size)));
  return rate;
}

/* Finite-difference step of x_j: a small part of the size of the body; of momenta 100 such steps times inertia and
   characteristic rate. */
static fb_real fbi_linear_step(const fbi_subject *s, int j)
{
  const fb_body *const body = s->body;
  const int n = body->n, first = fbi_first_free(body->base), free = 6 - first;
  const fb_real size = fbi_body_size(body);
  fb_real all;
  const fb_real rate = fbi_body_rates_find(&all, body, &s->work->steady, s->input);
  int moves;

  /* q, pi */
  if (j < n) {
    return fbi_difference_step(body, j);
  }
  if (j < 2 * n) {
    const fb_real inertia = fbi_form(body) ? FB_R(1.0) : body->M.diagonal[j - n];
    return FB_R(100.0) * fbi_difference_step(body, j - n) * inertia *
           fbi_own_rate(body->K.diagonal[j - n], body->M.diagonal[j - n], rate, all);
  }

  /* Momenta and pose of the base */
  moves = (j - 2 * n) % free + first < 3; /* the others are rotations */
  if (j < 2 * n + free) {
    return FB_R(100.0) * FBI_DIFFERENCE * body->mass * size * (moves ? FB_R(1.0) : size) * all;
  }
  return FBI_DIFFERENCE * (moves ? size : FB_R(1.0));
}

static int fbi_ports_fit(const fb_linear_desc *desc)
{
  return desc->n_in >= 0 && desc->n_in <= FB_MAX_PORTS && desc->n_out >= 0 && desc->n_out <= FB_MAX_PORTS;
}

static fb_status fbi_linear_desc_check(const fb_body *body, const fb_input *input, const fb_linear_desc *desc)
{
  FBI_REQUIRE(fbi_ports_fit(desc), FB_ERR_CAPACITY);
  for (int k = 0; k < desc->n_in + desc->n_out; k++) {
    const int is_input = k < desc->n_in;
    const fb_port *const port = is_input ? &desc->in[k] : &desc->out[k - desc->n_in];
    const fb_status status = fbi_port_check(port, is_input, FB_PORT_DRIVE, body->base == FB_BASE_PRESCRIBED,
                                            body->n_node, input->n_load < FB_MAX_LOADS);
    if (status != FB_OK || port->body != 0) {
      return status ? status : FB_ERR_CAPACITY;
    }
  }
  return FB_OK;
}

/* ---- finite-difference steps and channels of a system */

static fb_status fbi_system_port_check(const fbi_subject *s, const fb_port *port, int is_input)
{
  const fb_joint *joint;
  const fb_axis_mode *mode;
  fb_status status;
  FBI_REQUIRE(port->body >= 0 && port->body < s->system->n_body, FB_ERR_CAPACITY);
  joint = &s->system->joint[port->body];
  mode = s->system_state->mode[port->body];
  status = fbi_port_check(port, is_input, FB_PORT_COUNT, joint->kind == FB_JOINT_FREE && mode[0] == FB_AXIS_PRESCRIBED,
                          fbi_model(s->system, s->body, port->body)->n_node,
                          !s->system_input || s->system_input->n_load < FB_MAX_LOADS);
  if (status != FB_OK || port->kind < FB_PORT_DRIVE) {
    return status;
  }
  if (port->axis >= joint->n_axis) {
    return FB_ERR_CAPACITY;
  }
  return is_input && (joint->kind == FB_JOINT_FREE || mode[port->axis] != FB_AXIS_FREE) ? FB_ERR_VALUE : FB_OK;
}

static fb_status fbi_system_ports_check(const fbi_subject *s)
{
  fb_status status = FB_OK;
  FBI_REQUIRE(fbi_ports_fit(s->desc), FB_ERR_CAPACITY);
  for (int k = 0; k < s->desc->n_in && status == FB_OK; k++) {
    status = fbi_system_port_check(s, &s->desc->in[k], 1);
  }
  for (int k = 0; k < s->desc->n_out && status == FB_OK; k++) {
    status = fbi_system_port_check(s, &s->desc->out[k], 0);
  }
  return status;
}

/* Steady speeds and momenta along the axes of the joints. rate: the largest rate of rotation and flight of a body
   [1/s]. */
static fb_status fbi_system_steady(fb_real *rate, const fbi_subject *s)
{
  const fb_real size = fbi_system_size(s->system, s->body);
  fb_system_analyse_work *const work = s->system_work;
  const fb_status status =
      fb_system_rates_eval(s->system, s->body, &work->system, &work->rate, s->system_state, s->system_input);
  *rate = FB_R(0.0);
  for (int k = 0; k < s->system->n_body && status == FB_OK; k++) {
    const fbi_link_work *const L = &work->system.link[k];
    fbi_vec6_copy(work->steady[k], s->system->joint[k].kind == FB_JOINT_FREE ? L->V : L->u);
    fbi_vec6_copy(work->rest[k].speed, L->u);
    fbi_copy(work->rest[k].q_dot, work->rate.link[k].q, fbi_model(s->system, s->body, k)->n);
    if (s->system->joint[k].kind == FB_JOINT_FREE) {
      fbi_own_frame_add(work->steady[k], FB_R(1.0), &work->system, k);
      fbi_own_frame_add(work->rest[k].speed, FB_R(1.0), &work->system, k);
    }
    *rate = fbi_larger(*rate, fbi_vec3_norm(L->V + 3) + fbi_vec3_norm(L->V) / size);
  }
  if (status == FB_OK) {
    fbi_system_momenta(work->momenta, work->p_dot, s, s->system_state);
  }
  return status;
}

/* Finite-difference steps of the momenta: 100 steps of the coordinate times inertia and characteristic rate. Rates are
   quadratic in the momenta: large steps have no truncation error, small ones round-off. The poses of the bodies are
   known. */
static void fbi_momenta_steps(const fbi_subject *s, fb_real rate, fb_real other)
{
  fb_system_analyse_work *const work = s->system_work;
  fb_real *const step = work->common.step;
  const int n = work->n_independent;
  for (int j = 0; j < n; j++) {
    const fbi_coordinate *const c = &work->coordinate[work->independent[j]];
    const fb_body *const model = fbi_model(s->system, s->body, c->body);
    const fb_joint *const joint = &s->system->joint[c->body];
    const fb_real k = c->mode                        ? model->K.diagonal[c->i] / model->M.diagonal[c->i]
                      : joint->kind == FB_JOINT_FREE ? FB_R(0.0)
                                                     : joint->stiffness[fbi_is_ball(joint->kind) ? 0 : c->i];
    fb_real p[6], inertia;
    fbi_unit_momenta(p, s, c);
    inertia = c->mode ? work->moved.link[c->body].pi[c->i] : p[c->i];
    step[n + j] = FB_R(100.0) * step[j] * inertia * fbi_own_rate(k, c->mode ? FB_R(1.0) : inertia, rate, other);
  }
}

/* ---- derivatives with their errors, of bodies and systems */

/* Number of difference widths, each a quarter of the one before, and the first relative to the step. */
#define FBI_WIDTHS 5
#define FBI_WIDEST FB_R(4.0)
/* [E12.16] Column j of the Jacobian with an estimate of its error, by differences of five widths. From width to width
   the truncation error decreases 256 times (it is zero for polynomials of degree 4) and round-off increases 4 times.
   The difference between two successive widths is the error estimate of the wider. Each element is taken from the width
   with the least estimate; a narrower width must be 8 times better, so that accidents of round-off do not choose.
   Source: the error term of the five-point formula, h^4/30 f^(5).  Cost: 20 evaluations.  Fails: as the evaluations, if
   no two successive widths succeed.
   Test: shafts_with_disks_whirl_in_closed_form, errors_of_spectra_are_told. */
static fb_status fbi_derivative(fbi_analysis *work, const fbi_subject *s, int j, int count)
{
  fb_real h = FBI_WIDEST * work->step[j];
  fb_status status = FB_OK, before = FB_ERR_CONVERGENCE, found = FB_ERR_CONVERGENCE;
  for (int width = 0; width < FBI_WIDTHS; width++, h *= FB_R(0.25)) {
    status = fbi_difference(work, s, j, h, count);
    for (int i = 0; i < count && status == FB_OK && before == FB_OK; i++) {
      const fb_real miss = work->column[i] - work->wider[i];
      if (found != FB_OK || FB_R(8.0) * FB_FABS(miss) < FB_FABS(work->miss[i])) {
        work->miss[i] = miss;
        work->best[i] = work->wider[i];
      }
    }
    found = status == FB_OK && before == FB_OK ? FB_OK : found;
    before = status;
    fbi_copy(work->wider, work->column, count);
  }
  return found == FB_OK ? FB_OK : status ? status : found;
}

/* [E12.12] Derivatives by q at constant momenta p from those at constant velocities V, with P = dp/dq at constant V:
   f_q|_p = f_q|_V - f_p P
   for a row of A or C; miss: its error estimate, likewise. At constant velocities the rates are nearly polynomials of
   q; at constant momenta they contain the inverse of the mass matrix, which a small rotation of a heavy body on a light
   beam changes completely. An error of P acts as a gyroscopic term of that size only, whatever the inverse.
   Source: chain rule.  Shapes: P n_p x n_q.  Cost: 2 n_p n_q per row.  Fails: never.
   Test: shafts_with_disks_whirl_in_closed_form. */
static void fbi_momenta_hold(fb_real *row, fb_real *miss, const fbi_analysis *work, int n_q, int n_p)
{
  for (int j = 0; j < n_q; j++) {
    for (int k = 0; k < n_p; k++) {
      const fb_real P = work->P[k * n_q + j];
      row[j] -= row[n_q + k] * P;
      if (miss) {
        miss[j] -= row[n_q + k] * work->P_miss[k * n_q + j] + miss[n_q + k] * P;
      }
    }
  }
}

/* Tolerance of the largest error relative to the largest element (or eigenvalue). */
#define FBI_USABLE FB_R(0.01)
/* Largest element of the n x n matrix of a linear model with every state in units of its finite-difference step. */
static fb_real fbi_linear_norm(const fb_real *A, const fb_real *step, int n)
{
  fb_real norm = FB_R(0.0);
  for (int ij = 0; ij < n * n; ij++) {
    norm = fbi_larger(norm, FB_FABS(A[ij]) * step[ij % n] / step[ij / n]);
  }
  return norm;
}

/* Matrices of work->linear by differences, and E, the error estimates of A. The n_q columns of the coordinates come
   before those of the n_p momenta. */
static fb_status fbi_linear_fill(fbi_analysis *work, const fbi_subject *s, int n, int n_free)
{
  fb_linear *const out = &work->linear;
  const int n_p = n / 2, n_q = s->system ? n_p : n_p - n_free, rows = n + s->desc->n_out;
  fb_real norm;
  fb_status status = FB_OK;
  memset(out, 0, sizeof *out);
  out->n = n;
  out->n_free = n_free;
  out->n_in = s->desc->n_in;
  out->n_out = s->desc->n_out;

  /* Columns of A and C, then of B and D; P for the coordinates */
  for (int j = 0; j < n + out->n_in && status == FB_OK; j++) {
    status = fbi_derivative(work, s, j, j < n_q ? rows + n_p : rows);
    for (int i = 0; i < rows && status == FB_OK; i++) {
      fb_real *const row = i < n ? (j < n ? out->A + i * n : out->B + i * out->n_in)
                                 : (j < n ? out->C + (i - n) * n : out->D + (i - n) * out->n_in);
      row[j < n ? j : j - n] = work->best[i];
      if (i < n && j < n) {
        work->E[i * n + j] = work->miss[i];
      }
    }
    for (int k = 0; k < n_p && j < n_q && status == FB_OK; k++) {
      work->P[k * n_q + j] = work->best[rows + k];
      work->P_miss[k * n_q + j] = work->miss[rows + k];
    }
  }

  /* Derivatives at constant momenta, and the error relative to the largest element */
  for (int i = 0; i < rows && status == FB_OK; i++) {
    fbi_momenta_hold(i < n ? out->A + i * n : out->C + (i - n) * n, i < n ? work->E + i * n : NULL, work, n_q, n_p);
  }
  norm = status == FB_OK ? fbi_linear_norm(out->A, work->step, n) : FB_R(0.0);
  out->error = norm > FB_R(0.0) ? fbi_linear_norm(work->E, work->step, n) / norm : FB_R(0.0);
  return status == FB_OK && out->error > FBI_USABLE ? FB_ERR_CONVERGENCE : status;
}
#endif

#if FB_WITH_SYSTEM || FB_WITH_EXACT
/* Indices of the eigenvalues with im >= 0, ascending by |lambda|; returns their number. */
static int fbi_spectrum_order(int *order, const fb_real *re, const fb_real *im, int n)
{
  int found = 0;
  for (int k = 0; k < n; k++) {
    const fbi_complex value = {re[k], im[k]};
    int at = found;
    if (im[k] < FB_R(0.0)) {
      continue;
    }
    for (; at > 0; at--) {
      const fbi_complex other = {re[order[at - 1]], im[order[at - 1]]};
      if (fbi_complex_abs(other) <= fbi_complex_abs(value)) {
        break;
      }
      order[at] = order[at - 1];
    }
    order[at] = k;
    found++;
  }
  return found;
}
#endif

#if FB_WITH_SYSTEM
/* A + part E, rows and columns of the states keep[0..size-1]. */
static void fbi_spectrum_take(fb_real *A, const fbi_analysis *work, int size, fb_real part)
{
  const int n = work->linear.n, *const keep = work->keep;
  for (int i = 0; i < size * size; i++) {
    const int at = keep[i / size] * n + keep[i % size];
    A[i] = work->linear.A[at] + part * work->E[at];
  }
}

/* Distance of eigenvalue k from the nearest one of A + E. */
static fb_real fbi_spectrum_miss(const fbi_analysis *work, int k, int size)
{
  const fbi_complex own = {work->re[k], work->im[k]};
  fb_real miss = FB_HUGE;
  for (int i = 0; i < size; i++) {
    const fbi_complex d = {work->re[k] - work->other_re[i], work->im[k] - work->other_im[i]};
    const fb_real apart = fbi_complex_abs(d);
    miss = apart < miss ? apart : miss;
  }
  return fbi_larger(miss, FB_R(4.0) * FB_EPSILON * fbi_complex_abs(own));
}

/* [E12.3] Complex modes x = X exp(lambda t) of the states keep[0..size-1]: of each conjugate pair the one with im > 0,
   ascending by |lambda|. Shapes: the elements of states below `shaped`, at their coordinates among n_shape.
   Errors: distances to the eigenvalues of A + E, with E the error estimate of A.
   Source: [H] A.15-3 in the coordinates (q, pi).  Cost: E5.6 with size, twice.  Fails: as E5.6; an error > FBI_USABLE.
   Test: spectrum_of_a_spinning_oscillator_is_closed_form, damped_modes_have_their_ratios. */
static fb_status fbi_spectrum_fill(fb_spectrum *spectrum, fbi_analysis *work, int size, int shaped, int n_shape)
{
  const int *const keep = work->keep;
  fb_real least, largest = FB_R(0.0), worst = FB_R(0.0);
  int order[FB_MAX_LINEAR];
  fb_status status;

  /* Eigenvalues of A + E, then of A */
  fbi_spectrum_take(work->A, work, size, FB_R(1.0));
  status = fbi_eig_general(work->other_re, work->other_im, work->X, &least, work->A, work->eig, size);
  fbi_spectrum_take(work->A, work, size, FB_R(0.0));
  status = status ? status : fbi_eig_general(work->re, work->im, work->X, &least, work->A, work->eig, size);

  /* Errors; a double zero splits by the square root of round-off, in both matrices alike */
  for (int k = 0; k < size && status == FB_OK; k++) {
    const fbi_complex value = {work->re[k], work->im[k]};
    largest = fbi_larger(largest, fbi_complex_abs(value));
    work->miss[k] = fbi_spectrum_miss(work, k, size);
    worst = fbi_larger(worst, work->miss[k]);
    if (fbi_complex_abs(value) < least) {
      work->miss[k] = fbi_larger(work->miss[k], least / FB_SQRT((fb_real)size * FB_EPSILON));
    }
  }
  if (status == FB_OK && worst > FBI_USABLE * largest) {
    status = FB_ERR_CONVERGENCE;
  }
  if (status != FB_OK) {
    return status;
  }

  /* Values and shapes in ascending order */
  memset(spectrum, 0, sizeof *spectrum);
  spectrum->n = fbi_spectrum_order(order, work->re, work->im, size);
  for (int k = 0; k < spectrum->n; k++) {
    const fb_real *const x = work->X + 2 * size * order[k];
    spectrum->re[k] = work->re[order[k]];
    spectrum->im[k] = work->im[order[k]];
    spectrum->error[k] = work->miss[order[k]];
    for (int i = 0; i < size && keep[i] < shaped; i++) {
      spectrum->shape_re[k * n_shape + work->linear.coordinate[keep[i]]] = x[i];
      spectrum->shape_im[k * n_shape + work->linear.coordinate[keep[i]]] = x[size + i];
    }
  }
  return FB_OK;
}

static const fb_linear_desc *fbi_no_ports(fbi_analysis *work)
{
  memset(&work->none, 0, sizeof work->none);
  return &work->none;
}

/* Finite-difference steps of the inputs, stored behind those of the n states. */
static void fbi_body_port_steps(const fbi_subject *s, int n)
{
  const fb_body *const body = s->body;
  const fb_real size = fbi_body_size(body);
  fb_real all, V[6], force;
  const fb_real rate = fbi_body_rates_find(&all, body, &s->work->steady, s->input);
  fbi_copy(V, s->work->steady.v, 3);
  fbi_copy(V + 3, s->work->steady.w, 3);
  force = fbi_force_size(body, size, body->limit_elastic + body->limit_damping * rate + rate * rate) +
          body->mass * (fbi_vec3_norm(s->input->v_dot) + size * fbi_vec3_norm(s->input->w_dot));
  for (int i = 0; i < s->input->n_load; i++) {
    force += fbi_load_size(&s->input->load[i], size);
  }
  for (int k = 0; k < s->desc->n_in; k++) {
    const fb_port_kind kind = s->desc->in[k].kind;
    s->work->common.step[n + k] = fbi_port_step(kind, kind == FB_PORT_FORCE, force, size, all, V);
  }
}

/* Linear model of a body, in work->common.linear. */
static fb_status fbi_body_linearize(const fb_body *body, fb_analyse_work *work, const fb_state *state,
                                    const fb_input *input, const fb_linear_desc *desc)
{
  fbi_subject s;
  fb_status status = fbi_analyse_check(body, state, input);
  const int n_free = body ? 6 - fbi_first_free(body->base) : 0, n = body ? 2 * (body->n + n_free) : 0;

  /* Check the arguments; steady motion, with a prescribed base relative to the ground */
  FBI_REQUIRE(work, FB_ERR_NULL);
  s = fbi_subject_body(body, work, state, input, desc ? desc : fbi_no_ports(&work->common));
  status = status ? status : fbi_linear_desc_check(body, input, s.desc);
  status = status ? status : fb_body_motion_eval(body, &work->steady, state, input);
  if (status == FB_OK && body->base == FB_BASE_PRESCRIBED) {
    work->state = *state;
    status = fbi_state_of(body, &work->state, work->steady.v, work->steady.w, work->steady.q_dot);
    s.state = &work->state;
  }

  /* Finite-difference steps, then the matrices */
  for (int j = 0; j < n && status == FB_OK; j++) {
    work->common.step[j] = fbi_linear_step(&s, j);
  }
  if (status == FB_OK) {
    fbi_body_port_steps(&s, n);
  }
  status = status ? status : fbi_linear_fill(&work->common, &s, n, n_free);
  for (int a = 0; a < n / 2 - n_free && status == FB_OK; a++) {
    work->common.linear.coordinate[a] = a;
  }
  return status;
}

/* [E12.2] Linear model by differences of the rates and outputs.
   Source: definition.  Shapes: see fb_linear.  Cost: 20 (n + n_in) evaluations.  Fails: see the header.
   Test: spectrum_of_a_spinning_oscillator_is_closed_form, free_tops_nutate_as_euler_says,
   linear_models_answer_as_the_body_does. */
FB_DEF fb_status fb_body_linearize(const fb_body *body, fb_analyse_work *work, fb_linear *linear, const fb_state *state,
                                   const fb_input *input, const fb_linear_desc *desc)
{
  fb_status status;
  FBI_REQUIRE(linear, FB_ERR_NULL);
  status = fbi_body_linearize(body, work, state, input, desc);
  if (status == FB_OK) {
    *linear = work->common.linear;
  }
  return status;
}

/* Does the motion of a body depend on its position or attitude? */
static int fbi_pose_acts(const fb_body *body, const fb_input *input)
{
  int acts = fbi_has(body->effects, FB_EFFECT_GRAVITY);
  for (int k = 0; k < input->n_load; k++) {
    acts |= input->load[k].axes == FB_AXES_INERTIAL;
  }
  return acts;
}

FB_DEF fb_status fb_body_spectrum_solve(const fb_body *body, fb_analyse_work *work, fb_spectrum *spectrum,
                                        const fb_state *state, const fb_input *input)
{
  fb_status status;
  int size;
  FBI_REQUIRE(spectrum && work && body, FB_ERR_NULL);
  status = fbi_body_linearize(body, work, state, input, NULL);
  if (status != FB_OK) {
    return status;
  }
  size = work->common.linear.n - (fbi_pose_acts(body, input) ? 0 : work->common.linear.n_free);
  for (int i = 0; i < size; i++) {
    work->common.keep[i] = i;
  }
  return fbi_spectrum_fill(spectrum, &work->common, size, body->n, body->n);
}

/* Sum of the actuator efforts of a joint, torques divided by the length `size` [N]. */
static fb_real fbi_drive_size(const fb_joint *joint, const fb_drive *drive, fb_real size)
{
  fb_real force = FB_R(0.0);
  for (int i = 0; i < joint->n_axis && joint->kind != FB_JOINT_FREE; i++) {
    force += FB_FABS(drive->torque[i]) / (fbi_axis_slides(joint, i) ? FB_R(1.0) : size);
  }
  return force;
}

/* Order of magnitude of the forces on a system [N], inertia forces at the rate k [1/s^2]: the sum over bodies, loads
   and motors, since each can act on all bodies. */
static fb_real fbi_system_force(const fbi_subject *s, fb_real k)
{
  const fb_real size = fbi_system_size(s->system, s->body);
  const fb_system_input *const input = s->system_input;
  fb_real force = FB_R(0.0);
  for (int i = 0; i < s->system->n_body; i++) {
    const fb_body *const model = fbi_model(s->system, s->body, i);
    const fb_real *const given = input ? input->drive[i].acceleration : NULL;
    force += fbi_force_size(model, size, k);
    force += given ? model->mass * (fbi_vec3_norm(given) + size * fbi_vec3_norm(given + 3)) : FB_R(0.0);
  }
  for (int i = 0; input && i < input->n_load; i++) {
    force += fbi_load_size(&input->load[i].load, size);
  }
  for (int j = 0; input && j < s->system->n_body + s->system->n_loop; j++) {
    force += fbi_drive_size(&s->system->joint[j], &input->drive[j], size);
  }
  return force;
}

/* Characteristic rate of a system without rotation and flight [1/s]: of its slowest mode or, without modes, of the
   forces on it. */
static fb_real fbi_system_rate(const fbi_subject *s)
{
  const fb_real size = fbi_system_size(s->system, s->body);
  fb_real mass = FB_R(0.0), slow = FB_R(0.0);
  for (int i = 0; i < s->system->n_body; i++) {
    const fb_body *const model = fbi_model(s->system, s->body, i);
    mass += model->mass;
    for (int a = 0; a < model->n; a++) {
      const fb_real k = model->K.diagonal[a] / model->M.diagonal[a];
      slow = k > FB_R(0.0) && (slow == FB_R(0.0) || k < slow) ? k : slow;
    }
  }
  return slow > FB_R(0.0) ? FB_SQRT(slow) : FB_SQRT(fbi_system_force(s, FB_R(0.0)) / (mass * size));
}

static void fbi_system_port_steps(const fbi_subject *s, fb_real rate, fb_real other)
{
  fb_system_analyse_work *const work = s->system_work;
  const fb_real size = fbi_system_size(s->system, s->body);
  const fb_real force = fbi_system_force(s, s->system->limit_elastic + s->system->limit_damping * rate + rate * rate);
  for (int i = 0; i < s->desc->n_in; i++) {
    const fb_port *const port = &s->desc->in[i];
    const int slides = port->kind == FB_PORT_FORCE ||
                       (port->kind == FB_PORT_DRIVE && fbi_axis_slides(&s->system->joint[port->body], port->axis));
    work->common.step[2 * work->n_independent + i] = fbi_port_step(
        port->kind, slides, force, size, fbi_own_rate(FB_R(0.0), FB_R(0.0), rate, other), work->steady[port->body]);
  }
}

/* Sets the reference frames of trees with a prescribed root to rest: on a circular path their momenta are constant
   relative to the ground only. */
static void fbi_frames_ground(fb_system_state *state, fb_system_work *w, const fb_system *system, const fb_body *body)
{
  fbi_system_enter(w, system);
  fbi_links_place(w, system, body, state, state);

  /* Change of the frames' velocities */
  for (int k = 0; k < system->n_body; k++) {
    fbi_zero(w->link[k].change, 3);
  }
  for (int k = 0; k < system->n_body; k++) {
    fbi_link_work *const root = &w->link[w->link[k].root];
    if (system->joint[k].kind == FB_JOINT_FREE && state->mode[k][0] == FB_AXIS_PRESCRIBED) {
      fbi_zero(root->change, 3);
      fbi_vec3_add(root->change, -FB_R(1.0), state->link[k].u);
      fbi_vec3_add(root->change, -FB_R(1.0), state->link[k].lost_u);
    }
  }

  /* Momenta relative to the new frames */
  fbi_trees_weigh(w, system, 1);
  fbi_momenta_reframe(state, w, system);
  fbi_frames_set(state, w, system);
}

/* Linear model of a system, in work->common.linear. */
static fb_status fbi_system_linearize(const fb_system *system, const fb_body *body, fb_system_analyse_work *work,
                                      const fb_system_state *state, const fb_system_input *input,
                                      const fb_linear_desc *desc)
{
  fbi_subject s;
  fb_real rate, other;
  int n_free = 0;
  fb_status status = fbi_system_analyse_check(work, system, body, state, input);

  /* Check the arguments; steady motion, independent coordinates */
  FBI_REQUIRE(work, FB_ERR_NULL);
  s = fbi_subject_system(system, body, work, &work->state, input, desc ? desc : fbi_no_ports(&work->common));
  if (status == FB_OK) {
    work->state = *state;
    state = &work->state;
    fbi_frames_ground(&work->state, &work->system, system, body);
  }
  status = status ? status : fbi_system_ports_check(&s);
  status = status ? status : fbi_coordinates_find(work, system, body, state, 0);
  status = status ? status : fbi_loops_open(&s, state);
  status = status ? status : fbi_system_steady(&rate, &s);
  if (status != FB_OK) {
    return status;
  }

  /* Finite-difference steps */
  other = fbi_system_rate(&s);
  fbi_momenta_steps(&s, rate, other);
  fbi_system_port_steps(&s, rate, other);

  /* Matrices */
  for (int j = 0; j < work->n_independent; j++) {
    n_free += !work->coordinate[work->independent[j]].mode;
  }
  status = fbi_linear_fill(&work->common, &s, 2 * work->n_independent, n_free);
  for (int j = 0; j < work->n_independent; j++) {
    work->common.linear.coordinate[j] = work->independent[j];
  }
  return status ? status : fbi_loops_open(&s, state); /* Z of the steady state again, for the shapes */
}

/* [E12.9] Linear model of a system by differences of the rates and outputs.
   Source: definition.  Shapes: see fb_linear.  Cost: 20 (n + n_in) evaluations, with outputs twice.
   Fails: see the header.  Test: linear_models_answer_as_the_system_does, gimbal_has_the_published_eigenvalues. */
FB_DEF fb_status fb_system_linearize(const fb_system *system, const fb_body *body, fb_system_analyse_work *work,
                                     fb_linear *linear, const fb_system_state *state, const fb_system_input *input,
                                     const fb_linear_desc *desc)
{
  fb_status status;
  FBI_REQUIRE(linear, FB_ERR_NULL);
  status = fbi_system_linearize(system, body, work, state, input, desc);
  if (status == FB_OK) {
    *linear = work->common.linear;
  }
  return status;
}

/* Adds the dependent coordinates to a shape z that holds the independent ones. */
static void fbi_loops_shape(fb_real *z, const fb_system_analyse_work *work)
{
  for (int k = 0; k < work->n_dependent; k++) {
    const fb_real *const row = work->Z + k * (work->n + 1);
    fb_real sum = FB_R(0.0);
    for (int j = 0; j < work->n_independent; j++) {
      sum -= row[work->independent[j]] * z[work->independent[j]];
    }
    z[work->dependent[k]] = sum;
  }
}

/* Does the motion of a system depend on the poses of its free joints? */
static int fbi_system_pose_acts(const fb_system *system, const fb_body *body, const fb_system_input *input)
{
  int acts = 0;
  for (int k = 0; k < system->n_body; k++) {
    acts |= fbi_has(fbi_model(system, body, k)->effects, FB_EFFECT_GRAVITY);
  }
  for (int i = 0; input && i < input->n_load; i++) {
    acts |= input->load[i].load.axes == FB_AXES_INERTIAL;
  }
  return acts;
}

/* [E12.10] Complex modes of a system as E12.3, without poses of free joints that the motion does not depend on.
   Source: as E12.3.  Cost: E12.9 and E5.6.  Fails: as those.
   Test: a_free_body_is_a_system_of_one, gimbal_has_the_published_eigenvalues. */
FB_DEF fb_status fb_system_spectrum_solve(const fb_system *system, const fb_body *body, fb_system_analyse_work *work,
                                          fb_spectrum *spectrum, const fb_system_state *state,
                                          const fb_system_input *input)
{
  fb_status status;
  int size = 0, acts, n;
  FBI_REQUIRE(spectrum && work, FB_ERR_NULL);
  status = fbi_system_linearize(system, body, work, state, input, NULL);
  if (status != FB_OK) {
    return status;
  }

  /* States that take part */
  acts = fbi_system_pose_acts(system, body, input);
  n = work->n_independent;
  for (int j = 0; j < 2 * n; j++) {
    const fbi_coordinate *const c = &work->coordinate[work->independent[j % n]];
    if (acts || j >= n || c->mode || system->joint[c->body].kind != FB_JOINT_FREE) {
      work->common.keep[size++] = j;
    }
  }

  /* Modes; their shapes with the dependent coordinates */
  status = fbi_spectrum_fill(spectrum, &work->common, size, n, work->n);
  for (int k = 0; k < spectrum->n && status == FB_OK; k++) {
    fbi_loops_shape(spectrum->shape_re + k * work->n, work);
    fbi_loops_shape(spectrum->shape_im + k * work->n, work);
  }
  return status;
}
#endif

FB_DEF fb_real fb_spectrum_damping(const fb_spectrum *spectrum, int k)
{
  fbi_complex value;
  fb_real size;
  FBI_REQUIRE(spectrum && spectrum->n <= FB_MAX_LINEAR && k >= 0 && k < spectrum->n, FB_R(0.0));
  value.re = spectrum->re[k];
  value.im = spectrum->im[k];
  size = fbi_complex_abs(value);
  return size > FB_R(0.0) ? -value.re / size : FB_R(0.0);
}

FB_DEF fb_real fb_spectrum_margin(int *mode, const fb_real *re, int n)
{
  fb_real margin = FB_HUGE;
  int worst = -1;
  for (int k = 0; k < n && re; k++) {
    if (worst < 0 || !(-re[k] >= margin)) {
      margin = -re[k];
      worst = k;
    }
    if (!fbi_is_finite(&re[k], 1)) { /* NaN or infinite: that mode is the worst */
      break;
    }
  }
  if (mode) {
    *mode = worst;
  }
  return margin;
}

/* Stability function G(z) of an integrator, z = lambda dt: the factor of one step on exp(lambda t). rk4:
   1 + z (1 + z/2 (1 + z/3 (1 + z/4))).
   Source: [HW] IV.3.  Fails: never.  Test: step_limits_are_those_of_the_spectrum. */
static fbi_complex fbi_rk4_amplify(fbi_complex z)
{
  fbi_complex up = {FB_R(1.0), FB_R(0.0)};
  for (int k = 4; k > 0; k--) {
    up = fbi_complex_mul(z, up);
    up.re = FB_R(1.0) + up.re / (fb_real)k;
    up.im /= (fb_real)k;
  }
  return up;
}

/* (1 + z/2) / (1 - z/2) */
static fbi_complex fbi_midpoint_amplify(fbi_complex z)
{
  const fbi_complex up = {FB_R(1.0) + FB_R(0.5) * z.re, FB_R(0.5) * z.im};
  const fbi_complex down = {FB_R(1.0) - FB_R(0.5) * z.re, FB_R(0.0) - FB_R(0.5) * z.im};
  return fbi_complex_div(up, down);
}

/* (1 + (1 - 2 c) z) / (1 - c z)^2, c = 1 - 1/sqrt(2) */
static fbi_complex fbi_sdirk_amplify(fbi_complex z)
{
  const fb_real c = FB_R(1.0) - FB_SQRT(FB_R(0.5)), b = FB_R(1.0) - FB_R(2.0) * c;
  const fbi_complex up = {FB_R(1.0) + b * z.re, b * z.im};
  const fbi_complex down = {FB_R(1.0) - c * z.re, FB_R(0.0) - c * z.im};
  return fbi_complex_div(fbi_complex_div(up, down), down);
}

/* Stability, error and cost of each integrator of one body, in the order of fb_integrator.
   amplify: stability function G(z); NULL: the integrator solves the linear part exactly, so that its error does not
   follow from the eigenvalues.
   limit: longest step accepted; bounded: 1 if |G| <= 1 for every mode bounds the step.
   order: of accuracy, at least 2; leading: |G(z) - exp(z)| = leading |z|^(order + 1) for small z.
   evaluations: of the rates in a step; implicit: 1 if each solves a linear system; own: instructions beside them, of n
   modes own (1 + n). */
typedef struct fbi_integrator_traits {
  fbi_complex (*amplify)(fbi_complex z);
  fb_real (*limit)(const fb_body *body, fb_real spin, fb_real acceleration);
  fb_real leading, own;
  int order, bounded, evaluations, implicit;
} fbi_integrator_traits;

static const fbi_integrator_traits fbi_integrator_table[] = {
    {fbi_rk4_amplify, fb_rk4_limit, FB_R(8.3333333333333333e-3), FB_R(0.0), 4, 1, 4, 0},           /* RK4 */
    {fbi_midpoint_amplify, fb_implicit_limit, FB_R(8.3333333333333333e-2), FB_R(0.0), 2, 0, 3, 1}, /* MIDPOINT */
    {fbi_sdirk_amplify, fb_implicit_limit, FB_R(4.0440114519881e-2), FB_R(0.0), 2, 0, 5, 1},       /* SDIRK */
    {NULL, fb_exponential_limit, FB_R(0.0), FB_R(1500.0), 4, 0, 4, 0},                             /* EXPONENTIAL */
};
typedef char fbi_integrator_table_is_whole
    [sizeof fbi_integrator_table / sizeof fbi_integrator_table[0] == FB_INTEGRATOR_COUNT ? 1 : -1];

/* Has the integrator a stability function, so that its error follows from the eigenvalues? */
static int fbi_has_amplification(fb_integrator integrator)
{
  return fbi_is_choice((int)integrator, (int)FB_INTEGRATOR_COUNT - 1) && fbi_integrator_table[(int)integrator].amplify;
}

/* Stability function G(r d) of a step with |lambda| dt = r, of an eigenvalue lambda = |lambda| d. */
static fbi_complex fbi_amplification(fb_integrator integrator, fbi_complex d, fb_real r)
{
  const fbi_complex z = {r * d.re, r * d.im};
  return fbi_integrator_table[(int)integrator].amplify(z);
}

/* |G(r d)| > 1 by more than round-off? */
static int fbi_step_grows(fb_integrator integrator, fbi_complex d, fb_real r)
{
  return fbi_complex_abs(fbi_amplification(integrator, d, r)) > FB_R(1.0) + FBI_ROUNDING;
}

/* Largest r with |G(r d)| <= 1 for rk4: steps of 0.05 to the only crossing, then bisection. */
static fb_real fbi_stable_radius(fb_integrator integrator, fbi_complex d)
{
  fb_real low = FB_R(0.0), high = FB_R(0.0);
  for (int k = 1; k <= 64 && !(high > FB_R(0.0)); k++) { /* beyond 3.2 rk4 is unstable in every direction */
    const fb_real r = FB_R(0.05) * (fb_real)k;
    if (fbi_step_grows(integrator, d, r)) {
      high = r;
    } else {
      low = r;
    }
  }
  for (int k = 0; k < 40; k++) {
    const fb_real r = FB_R(0.5) * (low + high);
    const int grows = fbi_step_grows(integrator, d, r);
    low = grows ? low : r;
    high = grows ? r : high;
  }
  return low;
}

/* [E12.6] Largest stable step: |G(lambda dt)| <= 1 for every mode. A mode that grows by itself (re > 0, if only by
   round-off) is treated as undamped: the integrator must not make an oscillation of its frequency grow further.
   Source: [HW] IV.2.  Cost: 100 complex polynomials per mode.  Fails: see the header.
   Test: step_limits_are_those_of_the_spectrum, step_limits_hold_for_modes_that_grow. */
FB_DEF fb_real fb_spectrum_limit(const fb_spectrum *spectrum, fb_integrator integrator)
{
  fb_real limit = FB_HUGE;
  FBI_REQUIRE(spectrum && spectrum->n <= FB_MAX_LINEAR && fbi_has_amplification(integrator), FB_R(0.0));
  for (int k = 0; k < spectrum->n && fbi_integrator_table[(int)integrator].bounded; k++) {
    const fbi_complex value = {fbi_smaller(spectrum->re[k], FB_R(0.0)), spectrum->im[k]};
    const fb_real size = fbi_complex_abs(value);
    if (!fbi_is_finite(&spectrum->re[k], 1) || !fbi_is_finite(&size, 1)) {
      return FB_R(0.0);
    }
    if (size > FB_R(0.0)) {
      const fbi_complex d = {value.re / size, value.im / size};
      const fb_real step = fbi_stable_radius(integrator, d) / size;
      limit = step < limit ? step : limit;
    }
  }
  return limit;
}

/* Local error |G(z) - exp(z)| of a step, z = r d; for r < 0.3 the leading term of its series, since the difference
   loses digits. */
static fb_real fbi_step_error(fb_integrator integrator, fbi_complex d, fb_real r)
{
  const fbi_integrator_traits *is = &fbi_integrator_table[(int)integrator];
  const fb_real grown = FB_EXP(d.re * r);
  fbi_complex G;
  if (r < FB_R(0.3)) {
    fb_real beyond = FB_R(1.0); /* z^3 */
    for (int k = 2; k < is->order; k++) {
      beyond *= r;
    }
    return is->leading * r * r * r * beyond;
  }
  G = fbi_amplification(integrator, d, r);
  G.re -= grown * FB_COS(d.im * r);
  G.im -= grown * FB_SIN(d.im * r);
  return fbi_complex_abs(G);
}

/* Largest error of mode k with amplitude 1 within the duration, at a step of dt. After n steps it is
   n |G - exp(lambda dt)| exp(re (n - 1) dt): the sum of their local errors, which decay with the mode. Of a damped mode
   it is largest at n dt = 1/|re|, but not before the first step. */
static fb_real fbi_mode_error(const fb_spectrum *spectrum, int k, fb_integrator integrator, fb_real dt,
                              fb_real duration)
{
  const fbi_complex value = {spectrum->re[k], spectrum->im[k]};
  const fb_real size = fbi_complex_abs(value), decay = -value.re * duration;
  const fb_real longest = fbi_larger(decay > FB_R(1.0) ? duration / decay : duration, dt);
  const fbi_complex d = {size > FB_R(0.0) ? value.re / size : FB_R(0.0),
                         size > FB_R(0.0) ? value.im / size : FB_R(0.0)};
  return fbi_step_error(integrator, d, size * dt) * longest / dt * FB_EXP(value.re * (longest - dt));
}

static fb_real fbi_spectrum_error(const fb_spectrum *spectrum, fb_integrator integrator, const fb_real *amplitude,
                                  fb_real dt, fb_real duration)
{
  fb_real sum = FB_R(0.0);
  for (int k = 0; k < spectrum->n; k++) {
    const fb_real size = amplitude ? FB_FABS(amplitude[k]) : FB_R(1.0);
    sum += size == FB_R(0.0) ? size : size * fbi_mode_error(spectrum, k, integrator, dt, duration);
  }
  return sum;
}

/* [E12.7] Step for a given accuracy: sum_k amplitude_k error_k(dt) = tolerance. The smallest such dt, by doubling and
   bisection: the error of an L-stable integrator decreases again where a step is longer than the decay of a damped
   mode.
   Source: definition.  Cost: 100 errors per mode.  Fails: see the header.
   Test: advised_steps_err_as_wanted, advised_steps_bear_stiff_damping, advice_resolves_modes_that_die_out. */
FB_DEF fb_real fb_spectrum_dt(const fb_spectrum *spectrum, fb_integrator integrator, const fb_real *amplitude,
                              fb_real duration, fb_real tolerance)
{
  const fb_real most = fbi_smaller(FB_R(0.9) * fb_spectrum_limit(spectrum, integrator), duration);
  fb_real low = FB_R(0.0), high = FB_R(8.6736173798840355e-19) * most; /* 2^-60 */
  if (!spectrum || spectrum->n > FB_MAX_LINEAR || !fbi_has_amplification(integrator) || !(duration > FB_R(0.0)) ||
      !(tolerance > FB_R(0.0)) || !(most > FB_R(0.0)) ||
      !(fbi_spectrum_error(spectrum, integrator, amplitude, high, duration) >= FB_R(0.0))) { /* NaN */
    return FB_R(0.0);
  }

  /* Doubling to the first step whose error is too large, then bisection */
  for (int pass = 0; pass <= 60 && fbi_spectrum_error(spectrum, integrator, amplitude, high, duration) <= tolerance;
       pass++) {
    low = high;
    high *= FB_R(2.0);
  }
  for (int pass = 0; pass < 40 && low < most; pass++) {
    const fb_real dt = FB_R(0.5) * (low + high);
    const int errs = fbi_spectrum_error(spectrum, integrator, amplitude, dt, duration) > tolerance;
    low = errs ? low : dt;
    high = errs ? dt : high;
  }
  return low;
}

#if FB_WITH_EXACT
/* ---- the linearized geometrically exact beam: a perturbation x holds the changes d of the nodes' poses, then those of
   the momenta of elements and lumped bodies */

static int fbi_exact_dim(const fb_exact *m)
{
  return 6 * (m->n + 1) + 6 * m->n + 6 * m->n_lump;
}

/* Change of the inertia force of an element or lumped body by a velocity change v:
   y = ad(V)^T M v + ad(v)^T P - shift M v. */
static void fbi_exact_load_rate(fb_real y[6], const fb_real M[36], const fb_real V[6], const fb_real P[6],
                                fb_real shift, const fb_real v[6])
{
  fb_real p[6], a[6];
  fbi_mat66_mul_vec6(p, M, v);
  fbi_adT(y, V, p);
  fbi_adT(a, v, P);
  for (int i = 0; i < 6; i++) {
    y[i] += a[i] - shift * p[i];
  }
}

/* [E12.4] x = (shift - A)^-1 b of the linearized beam: d_t = shift d - b_d, v = d_t + ad(V) d, P_t = shift P - b_P. The
   terms in b are added to the right-hand side B of the nodes, which holds minus the loads on them; the matrix is the
   Jacobian of a steady state with inertia. On return dd holds the velocities of the nodes, ds the internal forces.
   Source: E10.7 to E10.10, linearized.  Cost: 1 kflop per element.  Fails: never, once factored.
   Test: spectrum_of_a_straight_beam_is_the_textbooks. */
static void fbi_exact_respond(fb_real *x, fb_exact_work *work, const fb_exact *m, const fb_real *b)
{
  fbi_exact_cell *const c = &work->cell;
  const fb_real shift = work->motion.shift;
  const int n = m->n;
  const fb_real *const b_P = b + 6 * (n + 1), *const b_L = b_P + 6 * n;
  fb_real *const P = x + 6 * (n + 1), *const L = P + 6 * n;
  fb_real v[6], d[6], f[6], y[6];
  fbi_zero(work->c, 6 * n);
  fbi_zero(work->want, 6 * (n + 1));

  /* Right-hand side: b of the elements, shared between their nodes */
  for (int k = 0; k < n; k++) {
    fbi_exact_cell_eval(c, work, m, k);
    fbi_exact_mean(v, d, c->theta, b + 6 * k, b + 6 * k + 6);
    fbi_exact_load_rate(f, m->M + 36 * k, c->V, c->P, shift, v);
    for (int i = 0; i < 6; i++) {
      f[i] = -c->h * (b_P[6 * k + i] - f[i]);
    }
    fbi_adT(y, c->theta, f);
    for (int i = 0; i < 6; i++) {
      work->B[6 * k + i] -= y[i] / FB_R(12.0) - FB_R(0.5) * f[i];
      work->B[6 * k + 6 + i] += y[i] / FB_R(12.0) + FB_R(0.5) * f[i];
    }
  }

  /* b of the lumped bodies */
  for (int l = 0; l < m->n_lump; l++) {
    const int j = m->lump_node[l];
    fb_real p[6];
    fbi_mat66_mul_vec6(p, m->lump + 36 * l, work->V + 6 * j);
    fbi_exact_load_rate(f, m->lump + 36 * l, work->V + 6 * j, p, shift, b + 6 * j);
    for (int i = 0; i < 6; i++) {
      work->B[6 * j + i] -= b_L[6 * l + i] - f[i];
    }
  }

  /* Poses d, and velocities of the nodes in dd */
  fbi_exact_solve(work, m);
  fbi_copy(x, work->dd, 6 * (n + 1));
  for (int j = 0; j <= n; j++) {
    fbi_ad(y, work->V + 6 * j, x + 6 * j);
    for (int i = 0; i < 6; i++) {
      work->dd[6 * j + i] = shift * x[6 * j + i] + y[i] - b[6 * j + i];
    }
  }

  /* Momenta */
  for (int k = 0; k < n; k++) {
    fb_real turn[6];
    fbi_exact_cell_eval(c, work, m, k);
    fbi_exact_mean(v, d, c->theta, work->dd + 6 * k, work->dd + 6 * k + 6);
    fbi_mat66_mul_vec6(turn, m->C + 36 * k, work->ds + 6 * k);
    fbi_ad(y, turn, c->dV);
    fbi_vec6_add(v, c->h / FB_R(12.0), y);
    fbi_mat66_mul_vec6(P + 6 * k, m->M + 36 * k, v);
  }
  for (int l = 0; l < m->n_lump; l++) {
    fbi_mat66_mul_vec6(L + 6 * l, m->lump + 36 * l, work->dd + 6 * m->lump_node[l]);
  }
}

/* x = (shift - A)^-1 b without loads. */
static void fbi_exact_invert(fb_real *x, fb_exact_work *work, const fb_exact *m, const fb_real *b)
{
  fbi_zero(work->B, 6 * (m->n + 1));
  fbi_exact_respond(x, work, m, b);
}

/* Linearizes the beam about a steady state and factors shift - A; shift in units of 1/m->time. */
static fb_status fbi_exact_linearize(fb_exact_work *work, const fb_exact *m, const fb_exact_state *state,
                                     const fb_exact_input *input, fb_real shift)
{
  const fbi_exact_motion motion = {0, 1, 0, 0, FB_R(1.0), shift};
  fbi_exact_cell *const c = &work->cell;
  work->motion = motion;
  fbi_exact_pose_take(work, state, m);
  fbi_exact_input_take(work, m, state->base_quat, input, FB_R(1.0), FB_R(0.0));
  fbi_exact_nodes_eval(work, m);
  for (int k = 0; k < m->n; k++) {
    fbi_exact_cell_eval(c, work, m, k);
    fbi_vec6_copy(work->momentum + 6 * k, c->P);
  }
  for (int l = 0; l < m->n_lump; l++) {
    fbi_mat66_mul_vec6(work->lump + 6 * l, m->lump + 36 * l, work->V + 6 * m->lump_node[l]);
  }
  fbi_exact_residual(work, m);
  return fbi_exact_factor(work, m);
}

/* Gram-Schmidt, twice: subtracts from x its projections on the rows of Q (added to h), normalizes it and returns the
   norm it had before. If that is round-off, the Krylov space is exhausted and x is set to zero. */
static fb_real fbi_krylov_add(fb_real *x, fb_real *h, const fb_real *Q, int rows, int n, int stride)
{
  const fb_real before = FB_SQRT(fbi_dot(x, x, n));
  fb_real size;
  for (int pass = 0; pass < 2; pass++) {
    for (int i = 0; i < rows; i++) {
      const fb_real part = fbi_dot(Q + i * n, x, n);
      h[i * stride] += part;
      fbi_row_sub(x, part, Q + i * n, n);
    }
  }
  size = FB_SQRT(fbi_dot(x, x, n));
  for (int i = 0; i < n; i++) {
    x[i] = size > FB_R(16.0) * FB_EPSILON * before ? x[i] / size : FB_R(0.0);
  }
  return size;
}

/* [E12.5] Block Arnoldi method: Krylov basis Q of (shift - A)^-1 from two start vectors, so that pairs of equal
   frequencies are found, and the operator H on it. first: the first start vector, or NULL for a random one.
   Source: [GV] 10.5.  Cost: size * (E12.4 + 4 size dim).  Fails: never.
   Test: spectrum_of_a_straight_beam_is_the_textbooks. */
static void fbi_exact_arnoldi(fb_exact_spectrum_work *work, const fb_exact *m, int size, const fb_real *first)
{
  const int n = fbi_exact_dim(m), s = FBI_EXACT_BASIS;
  unsigned seed = 12345u;
  fb_real *const start = work->x;
  int rows = 0;
  fbi_zero(work->H, (FBI_EXACT_BASIS + 2) * FBI_EXACT_BASIS);

  /* Start vectors: random displacements and velocities, mapped into the range of the operator */
  for (int k = 0; k < 2; k++) {
    fb_real none[2] = {FB_R(0.0), FB_R(0.0)}, v[6];
    for (int i = 0; i < n; i++) {
      seed = seed * 1664525u + 1013904223u;
      start[i] = (fb_real)(seed >> 16 & 0x7fffu) / FB_R(32768.0) - FB_R(0.5);
    }
    for (int i = 0; i < m->n + m->n_lump; i++) {
      fb_real *const P = start + 6 * (m->n + 1 + i);
      fbi_vec6_copy(v, P);
      fbi_mat66_mul_vec6(P, i < m->n ? m->M + 36 * i : m->lump + 36 * (i - m->n), v);
    }
    fbi_exact_invert(work->Q + rows * n, &work->exact, m, start);
    if (k == 0 && first) {
      fbi_copy(work->Q, first, n);
    }
    (void)fbi_krylov_add(work->Q + rows * n, none, work->Q, rows, n, 1);
    rows++;
  }

  /* Basis and H, column by column */
  for (int k = 0; k < size; k++) {
    fb_real *const q = work->Q + rows * n;
    fb_real left;
    fbi_exact_invert(q, &work->exact, m, work->Q + k * n);
    left = fbi_krylov_add(q, work->H + k, work->Q, rows, n, s);
    work->H[rows * s + k] = left;
    rows++;
  }
}

/* Residual of eigenvector k outside the basis, relative to its eigenvalue mu. */
static fb_real fbi_exact_missing(const fb_exact_spectrum_work *work, int k, int size)
{
  const fb_real *const y = work->X + 2 * size * k;
  const fbi_complex mu = {work->re[k], work->im[k]};
  fb_real sum = FB_R(0.0);
  for (int row = size; row < size + 2; row++) {
    fbi_complex r = {FB_R(0.0), FB_R(0.0)};
    for (int i = 0; i < size; i++) {
      r.re += work->H[row * FBI_EXACT_BASIS + i] * y[i];
      r.im += work->H[row * FBI_EXACT_BASIS + i] * y[size + i];
    }
    sum += fbi_complex_abs(r);
  }
  return sum / fbi_complex_abs(mu);
}

/* Eigenvalues lambda = shift - 1/mu of the beam from those of the operator. Eigenvalues that have not converged (they
   converge from the slowest on; single ones in between are artifacts of the basis) get im = -1 and are left out. */
static void fbi_exact_lambda(fb_exact_spectrum_work *work, int size)
{
  const fbi_complex one = {FB_R(1.0), FB_R(0.0)};
  for (int k = 0; k < size; k++) {
    const fbi_complex mu = {work->re[k], work->im[k]};
    work->missing[k] = fbi_complex_abs(mu) > FBI_ROUNDING ? fbi_exact_missing(work, k, size) : FB_HUGE;
    work->im[k] = -FB_R(1.0);
    if (work->missing[k] < (FB_SINGLE ? FB_R(1e-2) : FB_R(1e-6))) {
      const fbi_complex inverse = fbi_complex_div(one, mu);
      work->re[k] = work->exact.motion.shift - inverse.re;
      work->im[k] = -inverse.im;
    }
  }
}

/* First `rows` elements of eigenvector k, scaled so that the largest displacement or rotation of a node is 1 in the
   units of the beam. */
static void fbi_exact_vector(fb_real *re, fb_real *im, const fb_exact_spectrum_work *work, const fb_exact *m, int k,
                             int size, int rows)
{
  const int n = fbi_exact_dim(m), nodes = 6 * (m->n + 1);
  const fb_real *const y = work->X + 2 * size * k;
  fb_real largest = FB_R(0.0);
  fbi_complex top = {FB_R(1.0), FB_R(0.0)};

  /* Q^T y */
  fbi_zero(re, rows);
  fbi_zero(im, rows);
  for (int i = 0; i < size; i++) {
    fbi_row_sub(re, -y[i], work->Q + i * n, rows);
    fbi_row_sub(im, -y[size + i], work->Q + i * n, rows);
  }

  /* Divided by its largest element at the nodes */
  for (int i = 0; i < nodes; i++) {
    const fbi_complex z = {re[i], im[i]};
    if (fbi_complex_abs(z) > largest) {
      largest = fbi_complex_abs(z);
      top = z;
    }
  }
  for (int i = 0; i < rows; i++) {
    const fbi_complex z = {re[i], im[i]}, scaled = fbi_complex_div(z, top);
    re[i] = scaled.re;
    im[i] = scaled.im;
  }
}

/* Shape of eigenvector k at the nodes, scaled so that the largest displacement, or rotation times length, is 1 m. */
static void fbi_exact_shape(fb_real *re, fb_real *im, const fb_exact_spectrum_work *work, const fb_exact *m, int k,
                            int size)
{
  const int nodes = 6 * (m->n + 1);
  fbi_exact_vector(re, im, work, m, k, size, nodes);
  for (int i = 0; i < nodes; i++) {
    re[i] /= i % 6 < 3 ? FB_R(1.0) : m->length;
    im[i] /= i % 6 < 3 ? FB_R(1.0) : m->length;
  }
}

/* Linearizes and factors the beam at the first of three shifts that is not an eigenvalue. */
static fb_status fbi_exact_shifted(fb_exact_work *work, const fb_exact *m, const fb_exact_state *state,
                                   const fb_exact_input *input)
{
  fb_status status = FB_ERR_SINGULAR;
  for (int k = 0; k < 3 && status == FB_ERR_SINGULAR; k++) {
    status = fbi_exact_linearize(work, m, state, input, FB_R(1.0) + FB_R(0.37) * (fb_real)k);
  }
  return status;
}

/* Eigenvalues mu of the operator on its basis, with the right eigenvectors or (transpose) the left ones. */
static fb_status fbi_exact_eigen(fb_exact_spectrum_work *work, int size, int transpose)
{
  for (int i = 0; i < size; i++) {
    for (int j = 0; j < size; j++) {
      work->A[i * size + j] = transpose ? work->H[j * FBI_EXACT_BASIS + i] : work->H[i * FBI_EXACT_BASIS + j];
    }
  }
  return fb_eig_general_solve(work->re, work->im, work->X, work->A, work->eig, size);
}

/* Dimension of the basis for `count` modes. */
static int fbi_exact_basis(const fb_exact *m, int count)
{
  const int size = 6 * count + 24 < FBI_EXACT_BASIS ? 6 * count + 24 : FBI_EXACT_BASIS;
  return size < fbi_exact_dim(m) ? size : fbi_exact_dim(m);
}

/* Converged eigenvalues lambda of the linearized beam in ascending order, with their vectors on the basis; found: their
   number. */
static fb_status fbi_exact_modes(int *found, int order[FBI_EXACT_BASIS], fb_exact_spectrum_work *work,
                                 const fb_exact *m, const fb_exact_state *state, const fb_exact_input *input, int count)
{
  const int size = fbi_exact_basis(m, count);
  fb_status status = fbi_exact_shifted(&work->exact, m, state, input);
  if (status == FB_OK) {
    fbi_exact_arnoldi(work, m, size, NULL);
    status = fbi_exact_eigen(work, size, 0);
  }
  if (status != FB_OK) {
    return status;
  }
  fbi_exact_lambda(work, size);
  *found = fbi_spectrum_order(order, work->re, work->im, size);
  return *found >= count ? FB_OK : size < fbi_exact_dim(m) ? FB_ERR_CONVERGENCE : FB_ERR_MODES;
}

FB_DEF fb_status fb_exact_spectrum_solve(const fb_exact *m, fb_exact_spectrum_work *work, fb_exact_spectrum *spectrum,
                                         const fb_exact_state *state, const fb_exact_input *input, int count)
{
  int found, order[FBI_EXACT_BASIS], nodes;
  fb_status status;

  /* Check the arguments; eigenvalues and vectors on the basis */
  FBI_REQUIRE(m && spectrum && work && state, FB_ERR_NULL);
  if (count < 1 || count > FB_EXACT_MODES) {
    return FB_ERR_VALUE;
  }
  input = input ? input : fbi_exact_no_input(&work->exact);
  status = fb_exact_state_check(m, state);
  status = status ? status : fbi_exact_input_check(m, input);
  status = status ? status : fbi_exact_modes(&found, order, work, m, state, input, count);
  if (status != FB_OK) {
    return status;
  }

  /* Values and shapes in SI units */
  nodes = 6 * (m->n + 1);
  memset(spectrum, 0, sizeof *spectrum);
  spectrum->n = count;
  for (int k = 0; k < count; k++) {
    spectrum->re[k] = work->re[order[k]] / m->time;
    spectrum->im[k] = work->im[order[k]] / m->time;
    spectrum->error[k] = work->missing[order[k]];
    fbi_exact_shape(spectrum->shape_re + nodes * k, spectrum->shape_im + nodes * k, work, m, order[k],
                    fbi_exact_basis(m, count));
  }
  return FB_OK;
}

/* ---- modal models of the geometrically exact beam */

static fb_status fbi_exact_ports_check(const fb_exact *m, const fb_exact_linear_desc *desc)
{
  if (!fbi_is_choice(desc->n_in, FB_MAX_PORTS) || !fbi_is_choice(desc->n_out, FB_MAX_PORTS)) {
    return FB_ERR_CAPACITY;
  }
  for (int k = 0; k < desc->n_in + desc->n_out; k++) {
    const int is_in = k < desc->n_in;
    const fb_exact_port *const port = is_in ? &desc->in[k] : &desc->out[k - desc->n_in];
    const int kind = (int)port->kind, base = kind == 2 || kind == 3;
    if (!fbi_is_choice(port->axis, 2) || !fbi_is_choice(kind, (int)FB_EXACT_PORT_COUNT - 1) ||
        !fbi_is_choice((int)port->axes, (int)FB_AXES_COUNT - 1) || (kind <= (int)FB_EXACT_PORT_BASE_RATE) != is_in) {
      return FB_ERR_VALUE;
    }
    if (!base && !fbi_is_choice(port->at, kind >= (int)FB_EXACT_PORT_INTERNAL_FORCE ? m->n - 1 : m->n)) {
      return FB_ERR_CAPACITY;
    }
  }
  return FB_OK;
}

/* [E12.13] Response x (poses and momenta) of the linearized beam to a unit input that grows as exp(shift t): a load is
   subtracted from the balance of its node; a moving base carries the nodes along, v = d_t + ad(V) d + carried.
   Source: E12.4.  Cost: as E12.4.  Fails: never, once factored.
   Test: linear_beams_rest_where_the_beam_does, linear_beams_move_as_the_beam_does. */
static void fbi_exact_port_answer(fb_real *x, fb_exact_linear_work *w, const fb_exact *m, const fb_exact_port *port)
{
  fb_exact_work *const work = &w->spectrum.exact;
  const fb_real none[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)};
  fb_real unit[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)}, *const b = w->other;
  fbi_zero(b, fbi_exact_dim(m));
  fbi_zero(work->B, 6 * (m->n + 1));
  unit[port->axis] = FB_R(1.0);

  /* Force or torque on a node, else a velocity of the base */
  if (port->kind == FB_EXACT_PORT_FORCE || port->kind == FB_EXACT_PORT_TORQUE) {
    fb_real dead[6], follower[6], base[9], f[3], *const B = work->B + 6 * port->at;
    fbi_vec6_zero(dead);
    fbi_vec6_zero(follower);
    fb_quat_to_mat33(base, w->base_quat);
    fbi_exact_load_add(dead, follower, port->axes, port->kind == FB_EXACT_PORT_FORCE ? unit : none,
                       port->kind == FB_EXACT_PORT_FORCE ? none : unit, FB_R(1.0) / m->force, m->length, base);
    for (int i = 0; i < 6; i += 3) {
      fb_mat33_mulT_vec3(f, work->R + 9 * port->at, dead + i);
      fbi_vec3_add(B + i, -FB_R(1.0), f);
      fbi_vec3_add(B + i, -FB_R(1.0), follower + i);
    }
  } else {
    fbi_zero(work->twist, 6);
    fbi_vec3_add(work->twist + (port->kind == FB_EXACT_PORT_BASE_VELOCITY ? 0 : 3),
                 port->kind == FB_EXACT_PORT_BASE_VELOCITY ? m->time / m->length : m->time, unit);
    for (int j = 0; j <= m->n; j++) {
      fb_real carried[6];
      fbi_exact_carried(carried, work, work->r + 3 * j, work->R + 9 * j);
      fbi_vec6_add(b + 6 * j, -FB_R(1.0), carried);
    }
  }
  fbi_exact_respond(x, work, m, b);
}

/* Output of a channel from the poses x, velocities dd and internal forces ds of E12.4. */
static fb_real fbi_exact_port_read(const fb_exact_work *work, const fb_exact *m, const fb_real *x,
                                   const fb_exact_port *port)
{
  const int i = port->axis, at = 6 * port->at;
  switch (port->kind) {
  case FB_EXACT_PORT_DISPLACEMENT:
    return fb_vec3_dot(work->R + 9 * port->at + 3 * i, x + at) * m->length;
  case FB_EXACT_PORT_ROTATION:
    return x[at + 3 + i];
  case FB_EXACT_PORT_VELOCITY:
    return work->dd[at + i] * m->length / m->time;
  case FB_EXACT_PORT_RATE:
    return work->dd[at + 3 + i] / m->time;
  case FB_EXACT_PORT_INTERNAL_FORCE:
    return work->ds[at + i] * m->force;
  case FB_EXACT_PORT_INTERNAL_MOMENT:
    return work->ds[at + 3 + i] * m->force * m->length;
  case FB_EXACT_PORT_FORCE_STRAIN:
    return fbi_vec6_dot(m->section + 36 * port->at + 6 * i, work->ds + at);
  default:
    return fbi_vec6_dot(m->section + 36 * port->at + 18 + 6 * i, work->ds + at) / m->length;
  }
}

/* shift - lambda of mode k, in units of 1/m->time. */
static fbi_complex fbi_exact_distance(const fb_exact_linear_work *w, const fb_exact *m, int k)
{
  const fbi_complex d = {w->spectrum.exact.motion.shift - w->linear.re[k] * m->time, -w->linear.im[k] * m->time};
  return d;
}

/* Number of modes to keep, at least `count`: those with equal eigenvalues stay together. */
static int fbi_exact_keep(const fb_exact_spectrum_work *work, const int *order, int found, int count)
{
  while (count < found) {
    const int a = order[count - 1], b = order[count];
    const fbi_complex apart = {work->re[b] - work->re[a], work->im[b] - work->im[a]}, one = {work->re[a], work->im[a]};
    if (fbi_complex_abs(apart) > (FB_SINGLE ? FB_R(1e-2) : FB_R(1e-5)) * fbi_complex_abs(one)) {
      break;
    }
    count++;
  }
  return count;
}

/* A and C of the modes, and the QR factors of their vectors, `basis` and R. The outputs of a vector come from
   (shift - A)^-1, which returns it times mu = 1/(shift - lambda), with its velocities and internal forces:
   c = output * (shift - lambda). */
static fb_status fbi_exact_linear_modes(fb_exact_linear_work *w, const fb_exact *m, const fb_exact_linear_desc *desc,
                                        int size)
{
  fb_exact_linear *const out = &w->linear;
  const int dim = fbi_exact_dim(m), n = out->n, stride = FB_EXACT_STATES;
  fbi_zero(w->R, FB_EXACT_STATES * FB_EXACT_STATES);
  for (int k = 0, at = 0; k < out->n_mode; k++) {
    const int pair = out->im[k] > FB_R(0.0);
    const fbi_complex distance = fbi_exact_distance(w, m, k);
    fb_real *const re = w->basis + at * dim, *const im = pair ? re + dim : w->other;
    fb_real read[2][FB_MAX_PORTS];

    /* Vector scaled to 1 m; as a pair of real states, Re(x (a + i b)) = Re x a - Im x b */
    fbi_exact_vector(re, im, &w->spectrum, m, w->order[k], size, dim);
    for (int i = 0; i < dim; i++) {
      re[i] /= m->length;
      im[i] /= -m->length;
    }

    /* Rows of C and block of A */
    for (int part = 0; part <= pair; part++) {
      fbi_exact_invert(w->answer, &w->spectrum.exact, m, part ? im : re);
      for (int o = 0; o < desc->n_out; o++) {
        read[part][o] = fbi_exact_port_read(&w->spectrum.exact, m, w->answer, &desc->out[o]);
      }
      out->A[(at + part) * n + at + part] = out->re[k];
    }
    for (int o = 0; o < desc->n_out; o++) {
      const fbi_complex y = {read[0][o], pair ? -read[1][o] : FB_R(0.0)}, c = fbi_complex_mul(y, distance);
      out->C[o * n + at] = c.re;
      if (pair) {
        out->C[o * n + at + 1] = -c.im;
      }
    }
    if (pair) {
      out->A[at * n + at + 1] = -out->im[k];
      out->A[(at + 1) * n + at] = out->im[k];
    }

    /* QR factors */
    for (int part = 0; part <= pair; part++, at++) {
      fb_real *const R = w->R + at;
      R[at * stride] = fbi_krylov_add(w->basis + at * dim, R, w->basis, at, dim, stride);
      for (int i = 0; i < at; i++) { /* parallel vectors */
        if (!(R[at * stride] > (FB_SINGLE ? FB_R(1e-3) : FB_R(1e-7)) * FB_FABS(R[i * stride]))) {
          return FB_ERR_SINGULAR;
        }
      }
    }
  }
  return FB_OK;
}

/* Eigenvectors (right or left) on the basis for the eigenvalues of the modes, the nearest to each. */
static fb_status fbi_exact_pick(fb_real *out, fb_exact_linear_work *w, const fb_exact *m, int size)
{
  fb_exact_spectrum_work *const work = &w->spectrum;
  for (int k = 0; k < w->linear.n_mode; k++) {
    const fbi_complex distance = fbi_exact_distance(w, m, k);
    const int pair = w->linear.im[k] > FB_R(0.0);
    fb_real nearest = FB_SINGLE ? FB_R(3e-2) : FB_R(1e-4);
    int best = -1;

    /* mu (shift - lambda) nearest to 1 */
    for (int j = 0; j < size; j++) {
      const fbi_complex mu = {work->re[j], work->im[j]}, one = fbi_complex_mul(mu, distance);
      const fbi_complex off = {one.re - FB_R(1.0), one.im};
      if (work->im[j] >= FB_R(0.0) && (work->im[j] > FB_R(0.0)) == pair && fbi_complex_abs(off) < nearest) {
        nearest = fbi_complex_abs(off);
        best = j;
      }
    }
    if (best < 0) {
      return FB_ERR_CONVERGENCE;
    }

    /* Its vector; an eigenvalue is taken once */
    fbi_copy(out, work->X + 2 * size * best, (1 + pair) * size);
    work->im[best] = -FB_R(1.0);
    out += (1 + pair) * size;
  }
  return FB_OK;
}

/* [E12.14] Modal part of the response f to an input (E12.13), f = sum_k x_k b_k/(shift - lambda_k) + faster modes. A
   Krylov basis Q that starts from f contains it, f = Q e1 |f|, and H is the operator on that basis. With the right and
   left eigenvectors Y, W of H for the eigenvalues of the modes, the modal part is P f = Q Y (W^T Y)^-1 W^T e1 |f| (a
   spectral projection); its modal coordinates are R^-1 basis^T P f.
   Source: own; spectral projector.  Cost: E12.5 and two general eigenproblems of its size.  Fails: not all modes found.
   Test: linear_beams_move_as_the_beam_does, linear_beams_answer_at_every_frequency. */
static fb_status fbi_exact_project(fb_exact_linear_work *w, const fb_exact *m, int size)
{
  fb_exact_spectrum_work *const work = &w->spectrum;
  const int n = w->linear.n, dim = fbi_exact_dim(m);
  const fb_real length = FB_SQRT(fbi_dot(w->answer, w->answer, dim));
  fb_status status;
  fbi_zero(w->part, n);
  if (!(length > FB_R(0.0))) {
    return FB_OK;
  }

  /* Q, H, Y, W */
  fbi_exact_arnoldi(work, m, size, w->answer);
  status = fbi_exact_eigen(work, size, 0);
  status = status ? status : fbi_exact_pick(w->right, w, m, size);
  status = status ? status : fbi_exact_eigen(work, size, 1);
  status = status ? status : fbi_exact_pick(w->left, w, m, size);

  /* (W^T Y)^-1 W^T e1 |f| */
  for (int i = 0; i < n && status == FB_OK; i++) {
    w->sum[i] = w->left[i * size] * length;
    for (int j = 0; j < n; j++) {
      w->G[i * n + j] = fbi_dot(w->left + i * size, w->right + j * size, size);
    }
  }
  status = status ? status : fb_lu_factor(w->G, w->perm, w->scale, n);
  if (status != FB_OK) {
    return status;
  }
  fb_lu_solve(w->part, w->G, w->perm, w->sum, n);

  /* P f, then its modal coordinates */
  fbi_zero(w->other, dim);
  for (int j = 0; j < n; j++) {
    for (int i = 0; i < size; i++) {
      fbi_row_sub(w->other, -w->part[j] * w->right[j * size + i], work->Q + i * dim, dim);
    }
  }
  for (int i = n - 1; i >= 0; i--) {
    w->part[i] = fbi_dot(w->basis + i * dim, w->other, dim);
    for (int j = i + 1; j < n; j++) {
      w->part[i] -= w->R[i * FB_EXACT_STATES + j] * w->part[j];
    }
    w->part[i] /= w->R[i * FB_EXACT_STATES + i];
  }
  return FB_OK;
}

/* Column of B: b = (shift - lambda) times the modal part of the response. The static response of the modes, -b/lambda,
   is subtracted from D. */
static void fbi_exact_linear_input(fb_exact_linear_work *w, const fb_exact *m, int input)
{
  fb_exact_linear *const out = &w->linear;
  for (int k = 0, at = 0; k < out->n_mode; k++) {
    const int pair = out->im[k] > FB_R(0.0);
    const fbi_complex part = {w->part[at], pair ? w->part[at + 1] : FB_R(0.0)}, lambda = {out->re[k], out->im[k]};
    const fbi_complex b = fbi_complex_mul(fbi_exact_distance(w, m, k), part), rest = fbi_complex_div(b, lambda);
    const fb_real both[2][2] = {{b.re, rest.re}, {b.im, rest.im}};
    for (int i = 0; i <= pair; i++, at++) {
      out->B[at * out->n_in + input] = both[i][0] / m->time;
      for (int o = 0; o < out->n_out; o++) {
        out->D[o * out->n_in + input] += out->C[o * out->n + at] * both[i][1] / m->time;
      }
    }
  }
}

/* Checks the arguments and linearizes the beam about the state. */
static fb_status fbi_exact_linear_start(fb_exact_linear_work *w, const fb_exact *m, const fb_exact_state *state,
                                        const fb_exact_input *input, const fb_exact_linear_desc *desc, int count)
{
  fb_status status = count < 1 || count > FB_EXACT_MODES ? FB_ERR_VALUE : fbi_exact_ports_check(m, desc);
  status = status ? status : fb_exact_state_check(m, state);
  status = status ? status : fbi_exact_input_check(m, input);
  return status ? status : fbi_exact_linearize(&w->spectrum.exact, m, state, input, FB_R(0.0));
}

/* D = static gain of every pair of channels (E12.13 without shift). */
static void fbi_exact_linear_gain(fb_exact_linear_work *w, const fb_exact *m, const fb_exact_linear_desc *desc)
{
  for (int k = 0; k < desc->n_in; k++) {
    fbi_exact_port_answer(w->answer, w, m, &desc->in[k]);
    for (int o = 0; o < desc->n_out; o++) {
      w->linear.D[o * desc->n_in + k] = fbi_exact_port_read(&w->spectrum.exact, m, w->answer, &desc->out[o]);
    }
  }
}

/* Eigenvalues of the modes that are kept [1/s], and the number of states: 2 for a pair, 1 for a real eigenvalue. */
static fb_status fbi_exact_linear_poles(fb_exact_linear_work *w, const fb_exact *m, const fb_exact_state *state,
                                        const fb_exact_input *input, int count)
{
  fb_exact_linear *const out = &w->linear;
  int found = 0;
  const fb_status status = fbi_exact_modes(&found, w->order, &w->spectrum, m, state, input, count);
  if (status != FB_OK) {
    return status;
  }
  out->n_mode = fbi_exact_keep(&w->spectrum, w->order, found, count);
  if (out->n_mode > FB_EXACT_MODES) {
    return FB_ERR_VALUE;
  }
  for (int k = 0; k < out->n_mode; k++) {
    out->re[k] = w->spectrum.re[w->order[k]] / m->time;
    out->im[k] = w->spectrum.im[w->order[k]] / m->time;
    out->n += out->im[k] > FB_R(0.0) ? 2 : 1;
  }
  return FB_OK;
}

/* A and C of the modes, then B of each input; D keeps the static gain beyond that of the modes. */
static fb_status fbi_exact_linear_gains(fb_exact_linear_work *w, const fb_exact *m, const fb_exact_linear_desc *desc,
                                        int count)
{
  fb_status status = fbi_exact_linear_modes(w, m, desc, fbi_exact_basis(m, count));
  for (int k = 0; k < desc->n_in && status == FB_OK; k++) {
    fbi_exact_port_answer(w->answer, w, m, &desc->in[k]);
    status = fbi_exact_project(w, m, fbi_exact_basis(m, count));
    if (status == FB_OK) {
      fbi_exact_linear_input(w, m, k);
    }
  }
  return status;
}

/* [E12.15] Modal model of the beam: blocks of lambda, residues of E12.14, and in D the static response (E12.13 without
   shift) less that of the modes.
   Source: modal truncation with its static correction.  Cost: E12.14 for each input.  Fails: see the header.
   Test: linear_beams_rest_where_the_beam_does, linear_beams_move_as_the_beam_does. */
FB_DEF fb_status fb_exact_linearize(const fb_exact *m, fb_exact_linear_work *w, fb_exact_linear *linear,
                                    const fb_exact_state *state, const fb_exact_input *input,
                                    const fb_exact_linear_desc *desc, int count)
{
  static const fb_exact_linear_desc none = {
      0, 0, {{FB_EXACT_PORT_FORCE, 0, 0, FB_AXES_INERTIAL}}, {{FB_EXACT_PORT_FORCE, 0, 0, FB_AXES_INERTIAL}}};
  fb_status status;
  FBI_REQUIRE(m && linear && w && state, FB_ERR_NULL);
  desc = desc ? desc : &none;
  input = input ? input : fbi_exact_no_input(&w->spectrum.exact);
  status = fbi_exact_linear_start(w, m, state, input, desc, count);
  if (status != FB_OK) {
    return status;
  }

  /* Static gain, eigenvalues, modal matrices */
  memset(&w->linear, 0, sizeof w->linear);
  w->linear.n_in = desc->n_in;
  w->linear.n_out = desc->n_out;
  fbi_copy(w->base_quat, state->base_quat, 4);
  fbi_exact_linear_gain(w, m, desc);
  status = fbi_exact_linear_poles(w, m, state, input, count);
  status = status ? status : fbi_exact_linear_gains(w, m, desc, count);
  if (status == FB_OK) {
    *linear = w->linear;
  }
  return status;
}
#endif

/* ---------------------------------------------------------------------------------------------------------------
   ANALYSE >>advise: which effects, modes, integrator and step a scene calls for
   (uses config, status, vec3, solve, body, assemble, trim, linear) */

/* Candidate sets of effects, ascending in cost; the last is the full set. */
static const unsigned fbi_advice_set[FBI_ADVICE_SETS] = {
    FB_EFFECTS_LINEAR,
    FB_EFFECTS_SPIN,
    FB_EFFECTS_LINEAR | FB_EFFECT_SPIN_STIFFENING,
    FB_EFFECTS_LINEAR | FB_EFFECT_ACCELERATION_STIFFENING,
    FB_EFFECTS_SPIN | FB_EFFECT_SPIN_STIFFENING,
    FB_EFFECTS_LINEAR | FB_EFFECT_SPIN_STIFFENING | FB_EFFECT_ACCELERATION_STIFFENING,
    FB_EFFECTS_SPIN | FB_EFFECT_ACCELERATION_STIFFENING,
    FB_EFFECTS_SPIN | FB_EFFECT_SPIN_STIFFENING | FB_EFFECT_ACCELERATION_STIFFENING,
    FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA | FB_EFFECT_SPIN_STIFFENING,
    FB_EFFECTS_FULL};

#define FBI_ADVICE_FULL (FBI_ADVICE_SETS - 1)
/* Load cases ("instants") of an envelope: factors of spin, spin rate, acceleration and loads, since the extremes of all
   do not occur together. */
#define FBI_ADVICE_REST FBI_ADVICE_INSTANTS /* one more: at rest, without loads */
static const signed char fbi_advice_instant[FBI_ADVICE_INSTANTS + 1][4] = {{1, 1, 1, 1}, {1, 1, -1, 1}, {0, 1, 1, 1},
                                                                           {1, 0, 0, 1}, {0, 0, 0, 1},  {0, 0, 0, 0}};

/* Phases of an oscillation: factors of its deflection and of its speed. */
static const fb_real fbi_advice_phase[FBI_ADVICE_PHASES][2] = {
    {FB_R(1.0), FB_R(0.0)}, {FB_R(0.70710678118654752), FB_R(0.70710678118654752)}, {FB_R(0.0), FB_R(1.0)}};

/* FB_ERR_UNSUPPORTED unless the coordinates are natural modes: M = 1 and K diagonal, within 1e-3. */
static fb_status fbi_advise_modes_check(const fb_shape *shape)
{
  const int n = shape->n;
  for (int a = 0; a < n; a++) {
    for (int b = 0; b < n; b++) {
      const fb_real K = shape->K[a * n + b], M = shape->M[a * n + b] - (a == b ? FB_R(1.0) : FB_R(0.0));
      const fb_real little = FB_R(1e-3) * FB_SQRT(FB_FABS(shape->K[a * n + a] * shape->K[b * n + b]));
      if (!(FB_FABS(M) < FB_R(1e-3)) || !(a == b ? K > FB_R(0.0) : FB_FABS(K) < little)) {
        return FB_ERR_UNSUPPORTED;
      }
    }
  }
  return FB_OK;
}

static fb_status fbi_advise_check(const fb_shape *shape, const fb_body_desc *desc, const fb_envelope *e,
                                  fb_real tolerance)
{
  const fb_status status = fbi_shape_check(shape);
  if (status != FB_OK) {
    return status;
  }
  if (((FB_EFFECTS_FULL | FB_EFFECT_GRAVITY) & ~(unsigned)FBI_EFFECTS_BUILT) != 0) {
    return FB_ERR_EFFECTS;
  }
  if (!fbi_is_finite(e->velocity, 3) || !fbi_is_finite(e->spin, 3) || !fbi_is_finite(e->spin_rate, 3) ||
      !fbi_is_finite(e->acceleration, 3) || !fbi_is_finite(&e->duration, 1) || !fbi_is_finite(&e->frame, 1) ||
      !fbi_is_finite(&tolerance, 1)) {
    return FB_ERR_NOT_FINITE;
  }
  if (!(e->frequency >= FB_R(0.0)) || !(e->duration > FB_R(0.0)) || e->frame < FB_R(0.0) || !(tolerance > FB_R(0.0)) ||
      shape->n < 1 || !(desc->base == FB_BASE_PRESCRIBED || shape->mass > FB_R(0.0))) {
    return FB_ERR_VALUE;
  }
  FBI_REQUIRE(e->node > 0 && e->node < shape->n_node, FB_ERR_CAPACITY);
  return fbi_advise_modes_check(shape);
}

/* Body with a set of effects and the modes coordinate[] (NULL: all), with gravity, by which fbi_advise_motion applies
   all accelerations of the origin. */
static fb_status fbi_advise_body(fb_body *body, fb_advice_work *work, const fb_shape *shape, const fb_body_desc *desc,
                                 const int *coordinate, unsigned effects)
{
  work->desc = *desc;
  work->desc.effects = effects | FB_EFFECT_GRAVITY | (desc->effects & FB_EFFECT_DAMPING);
  work->desc.allow_long_step = 1;
  for (int k = 0; k < shape->n && coordinate; k++) {
    work->desc.zeta[k] = desc->zeta[coordinate[k]];
  }
  return fb_body_init(body, &work->body_work, shape, &work->desc);
}

/* Accelerations (work.motion) and displacement of the output (work.node) in a load case, at q, q_dot. */
static fb_status fbi_advise_motion(fb_advice_work *work, fb_body *body, const fb_envelope *e, int instant,
                                   const fb_real *q, const fb_real *q_dot)
{
  const signed char *const on = fbi_advice_instant[instant];
  fb_real v[3], w[3], turning[3];
  const int spins = on[0] || (instant != FBI_ADVICE_REST && fbi_is_zero(e->spin_rate, 3)); /* a steady spin: always */
  fb_status status;

  /* Motion of the base */
  memset(&work->state, 0, sizeof work->state);
  memset(&work->input, 0, sizeof work->input);
  work->state.quat[0] = FB_R(1.0);
  fbi_copy(work->state.q, q, body->n);
  for (int i = 0; i < 3; i++) {
    w[i] = spins ? e->spin[i] : FB_R(0.0);
    v[i] = spins && body->base == FB_BASE_PRESCRIBED ? e->velocity[i] : FB_R(0.0);
    work->input.v[i] = v[i];
    work->input.w[i] = w[i];
    work->input.w_dot[i] = (fb_real)on[1] * e->spin_rate[i];
  }

  /* Gravity in place of the acceleration of O, less w x v, which the body accounts for itself */
  fb_vec3_cross(turning, w, v);
#if FB_WITH_GRAVITY
  for (int i = 0; i < 3; i++) {
    body->gravity[i] = turning[i] - (fb_real)on[2] * e->acceleration[i];
  }
#endif

  /* Center of mass of a free body at rest: v = -w x c/m */
  if (body->base == FB_BASE_FREE) {
    fb_vec3_cross(v, body->c, w);
    for (int i = 0; i < 3; i++) {
      v[i] /= body->mass;
    }
  }

  /* Loads, then accelerations and displacement */
  work->input.n_load = on[3] ? e->n_load : 0;
  memcpy(work->input.load, e->load, sizeof e->load);
  status = fb_state_from_velocity(body, &work->state, v, w, q_dot);
  status = status ? status : fb_body_motion_eval(body, &work->motion, &work->state, &work->input);
  return status ? status : fb_body_node_motion_eval(body, &work->node, &work->state, &work->motion, e->node);
}

/* Tangent stiffness K = -d(q_ddot)/dq at q = 0 by central differences. */
static fb_status fbi_advise_tangent(fb_real *K, fb_advice_work *work, fb_body *body, const fb_envelope *e, int instant)
{
  const int n = body->n;
  fb_real q[FB_MAX_MODES];
  fb_status status = FB_OK;
  fbi_zero(q, n);
  for (int a = 0; a < n && status == FB_OK; a++) {
    const fb_real step = fbi_difference_step(body, a);
    for (int side = -1; side <= 1 && status == FB_OK; side += 2) {
      q[a] = (fb_real)side * step;
      status = fbi_advise_motion(work, body, e, instant, q, NULL);
      for (int b = 0; b < n; b++) {
        K[b * n + a] = (side < 0 ? FB_R(0.0) : K[b * n + a]) - (fb_real)side * work->motion.q_ddot[b] / (2 * step);
      }
    }
    q[a] = FB_R(0.0);
  }
  return status;
}

/* q = K^-1 f for the coordinates order[0..n-1]; the others are zero. */
static fb_status fbi_advise_solve(fb_real *q, fb_advice_work *work, const fb_real *K, const fb_real *f, int n)
{
  const int size = work->full.n;
  fb_real rhs[FB_MAX_MODES], x[FB_MAX_MODES];
  fb_status status;
  fbi_zero(rhs, FB_MAX_MODES);
  for (int k = 0; k < n; k++) {
    rhs[k] = f[work->order[k]];
    for (int l = 0; l < n; l++) {
      work->K[k * n + l] = K[work->order[k] * size + work->order[l]];
    }
  }
  status = fb_lu_factor(work->K, work->perm, work->scale, n);
  if (status != FB_OK) {
    return status;
  }
  fb_lu_solve(x, work->K, work->perm, rhs, n);
  fbi_zero(q, size);
  for (int k = 0; k < n; k++) {
    q[work->order[k]] = x[k];
  }
  return FB_OK;
}

/* Is the quasi-static response q valid? The diagonal of the tangent K is positive and the deflection of each mode below
   its limit; otherwise the body has buckled, or nearly so. */
static int fbi_advice_holds(const fb_advice_work *work, const fb_real *K, const fb_real *q)
{
  const fb_body *const body = &work->full;
  int holds = 1;
  for (int a = 0; a < body->n; a++) {
    holds &= K[a * body->n + a] > FB_R(0.0) && FB_FABS(q[a]) * body->reach[a] < body->deflection_limit;
  }
  return holds;
}

/* Dynamic amplification factor of a mode: 1/|1-r^2| for harmonic excitation, at least 2 (step load) from r = 1 on;
   limited at resonance by duration and damping. */
static fb_real fbi_advice_gain(const fb_advice_work *work, const fb_envelope *e, int a, fb_real omega)
{
  const fb_real r = e->frequency / omega, grown = fbi_larger(FB_R(3.0), FB_R(0.5) * omega * e->duration);
  const fb_real near = fbi_larger(FB_FABS(FB_R(1.0) - r * r), FB_R(1.0) / grown);
  return r < FB_R(1.0) ? FB_R(1.0) / fbi_larger(near, 2 * work->zeta[a] * r)
                       : fbi_larger(FB_R(1.0) / fbi_larger(near, 2 * work->zeta[a]), FB_R(2.0));
}

/* Scales q down to the deflection limit; returns the ratio to the limit if it was exceeded, else 1. */
static fb_real fbi_advice_bound(fb_real *q, const fb_body *body)
{
  fb_real sum = FB_R(0.0), beyond;
  for (int a = 0; a < body->n; a++) {
    sum += FB_FABS(q[a]) * body->reach[a];
  }
  beyond = sum > body->deflection_limit ? FB_R(1.01) * sum / body->deflection_limit : FB_R(1.0);
  for (int a = 0; a < body->n; a++) {
    q[a] /= beyond;
  }
  return beyond;
}

/* Frequency [rad/s] of a mode in a load case. */
static fb_real fbi_advice_omega(const fb_advice_work *work, int instant, int a)
{
  return FB_SQRT(work->tangent[instant][a * work->full.n + a]);
}

/* Displacement of the output by coordinates q. */
static void fbi_advice_output(fb_real y[3], const fb_advice_work *work, const fb_envelope *e, const fb_real *q)
{
  fbi_zero(y, 3);
  for (int a = 0; a < work->full.n; a++) {
    fbi_vec3_add(y, q[a], work->full.node[e->node].psi + 3 * a);
  }
}

/* Records the contributions of the modes to the output in load case i, whose displacement is `tip`. */
static void fbi_advise_note(fb_advice_work *work, const fb_envelope *e, int i, fb_real tip)
{
  for (int a = 0; a < work->full.n; a++) {
    const fb_real omega = fbi_advice_omega(work, i, a);
    const fb_real give = FB_FABS(work->q[i][a]) * fbi_vec3_norm(work->full.node[e->node].psi + 3 * a);
    work->most[a] = fbi_larger(work->most[a], give);
    work->omega[a] = fbi_larger(work->omega[a], omega);
    if (give > FB_R(0.5) * tip) { /* the mode that dominates the deflection: E13.4 */
      const fb_real turn = fbi_vec3_norm(work->input.w) * fbi_smaller(e->frequency, omega) / (omega * omega);
      work->drawn = fbi_larger(work->drawn, tip * turn);
    }
  }
}

/* [E13.1] Modal response in a load case: the quasi-static K q = f, K the tangent stiffness of the full set of effects
   (if that is unstable: the one at rest), times the dynamic amplification factor of each mode.
   Source: own; quasi-static response with dynamic amplification.  Cost: 2 n evaluations and an LU factorization.
   Fails: as fb_body_motion_eval.  Test: advice_estimates_the_deflection. */
static fb_status fbi_advise_answer(fb_advice_work *work, const fb_envelope *e, int i)
{
  const int n = work->full.n;
  fb_real *const q = work->q[i], *const K = work->tangent[i], tip, beyond;
  fb_status status = fbi_advise_tangent(K, work, &work->full, e, i);
  fbi_zero(q, n);
  status = status ? status : fbi_advise_motion(work, &work->full, e, i, q, NULL);
  if (status != FB_OK) {
    return status;
  }

  /* Quasi-static response */
  fbi_copy(work->f[i], work->motion.q_ddot, n);
  if (fbi_advise_solve(q, work, K, work->f[i], n) != FB_OK || !fbi_advice_holds(work, K, q)) {
    fbi_copy(K, work->tangent[FBI_ADVICE_REST], n * n);
    status = fbi_advise_solve(q, work, K, work->f[i], n);
    work->buckled |= fbi_advice_holds(work, K, q); /* otherwise the load is too large even without preload */
  }

  /* Dynamic amplification, within the deflection limit */
  for (int a = 0; a < n; a++) {
    q[a] *= fbi_advice_gain(work, e, a, fbi_advice_omega(work, i, a));
  }
  beyond = fbi_advice_bound(q, &work->full);

  /* Deflection of the output */
  status = status ? status : fbi_advise_motion(work, &work->full, e, i, q, NULL);
  if (status == FB_OK) {
    tip = fbi_vec3_norm(work->node.displacement);
    work->deflection = fbi_larger(work->deflection, tip);
    work->bend = fbi_larger(work->bend, beyond * tip);
    fbi_advise_note(work, e, i, tip);
  }
  return status;
}

static fb_status fbi_advise_answers(fb_advice_work *work, const fb_envelope *e)
{
  fb_status status = fbi_advise_tangent(work->tangent[FBI_ADVICE_REST], work, &work->body, e, FBI_ADVICE_REST);
  work->deflection = work->bend = work->drawn = FB_R(0.0);
  work->buckled = 0;
  for (int a = 0; a < work->full.n; a++) {
    work->order[a] = a;
    work->most[a] = work->omega[a] = FB_R(0.0);
  }
  for (int i = 0; i < FBI_ADVICE_INSTANTS && status == FB_OK; i++) {
    status = fbi_advise_answer(work, e, i);
  }
  return status;
}

/* Frequency at which a driven mode moves: that of the excitation, at most its own. */
static fb_real fbi_advice_rate(const fb_advice_work *work, const fb_envelope *e, int a)
{
  return fbi_smaller(e->frequency, work->omega[a]);
}

/* Part of a mode's contribution that oscillates at its natural frequency: the free vibration excited by a harmonic
   drive that starts with a jump of its slope. */
static fb_real fbi_advice_share(const fb_advice_work *work, const fb_envelope *e, int a)
{
  return fbi_advice_rate(work, e, a) / work->omega[a];
}

/* Orders the modes by their contribution to the output; ringing: mean phase that the free vibration runs through in
   half the duration [rad], weighted by contribution. */
static void fbi_advise_order(fb_advice_work *work, const fb_envelope *e)
{
  const int n = work->full.n;
  fb_real turn = FB_R(0.0), sum = FB_R(0.0);
  for (int a = 0; a < n; a++) {
    int rank = 0;
    for (int b = 0; b < n; b++) {
      rank += b < a ? !(work->most[b] < work->most[a]) : work->most[b] > work->most[a];
    }
    work->order[rank] = a;
    turn += work->most[a] * fbi_advice_share(work, e, a) * FB_R(0.5) * work->omega[a] * e->duration;
    sum += work->most[a];
  }
  work->ringing = sum > FB_R(0.0) ? turn / sum : FB_R(0.0);
}

/* [E13.2] Relative error of the output when accelerations are wrong by what is statically a part r of the output: r
   itself, and the phase error of the free vibration, whose frequency is wrong by r/2; at most twice the output.
   Source: own.  Fails: never.  Test: sets_err_by_the_change_of_frequency. */
static fb_real fbi_advice_error(const fb_advice_work *work, fb_real r)
{
  return r + fbi_smaller(r * work->ringing, FB_R(2.0));
}

/* Relative change of the stiffness of the first mode when the modes after the first n are condensed statically:
   sum K_ab K_ba/K_bb / K_aa. */
static fb_real fbi_advise_condensed(const fb_advice_work *work, int instant, int n)
{
  const int size = work->full.n, a = work->order[0];
  const fb_real *const K = work->tangent[instant];
  fb_real change = FB_R(0.0);
  for (int k = n; k < size && k < FB_MAX_MODES; k++) { /* the bound: gcc 12 -O3 warns at one mode */
    const int b = work->order[k];
    change += K[a * size + b] * K[b * size + a] / K[b * size + b];
  }
  return FB_FABS(change / K[a * size + a]);
}

/* Relative error of the output with the first n modes alone: the difference of the quasi-static responses, times the
   amplification factor of the first mode (near resonance the output depends on its frequency), and E13.2 of the change
   of its stiffness. */
static fb_real fbi_advise_modes(fb_advice_work *work, const fb_envelope *e, int n)
{
  fb_real worst = FB_R(0.0), all[FB_MAX_MODES], some[FB_MAX_MODES], y[3];
  const int first = work->order[0];
  for (int i = 0; i < FBI_ADVICE_INSTANTS; i++) {
    const fb_real gain = fbi_advice_gain(work, e, first, fbi_advice_omega(work, i, first));
    if (fbi_advise_solve(all, work, work->tangent[i], work->f[i], work->full.n) != FB_OK ||
        fbi_advise_solve(some, work, work->tangent[i], work->f[i], n) != FB_OK) {
      return FB_HUGE;
    }
    for (int a = 0; a < work->full.n; a++) {
      some[a] -= all[a];
    }
    fbi_advice_output(y, work, e, some);
    worst = fbi_larger(worst,
                       gain * fbi_vec3_norm(y) / work->bend + fbi_advice_error(work, fbi_advise_condensed(work, i, n)));
  }
  return worst;
}

/* Accelerations and displacement of the output for a body with the modes coordinate[0..] at a phase of its oscillation
   in load case `at`. */
static fb_status fbi_advise_phase(fb_advice_work *work, fb_body *body, const fb_envelope *e, const int *coordinate,
                                  int at, int phase)
{
  fb_real q[FB_MAX_MODES], q_dot[FB_MAX_MODES];
  for (int k = 0; k < body->n; k++) {
    const int a = coordinate[k];
    q[k] = fbi_advice_phase[phase][0] * work->q[at][a];
    q_dot[k] = fbi_advice_phase[phase][1] * work->q[at][a] * fbi_advice_rate(work, e, a);
  }
  return fbi_advise_motion(work, body, e, at, q, q_dot);
}

/* The same for the full set of effects with all modes, as the reference. */
static fb_status fbi_advise_full(fb_advice_work *work, const fb_envelope *e, const int *all)
{
  fb_status status = FB_OK;
  for (int k = 0; k < FBI_ADVICE_INSTANTS * FBI_ADVICE_PHASES && status == FB_OK; k++) {
    const int at = k / FBI_ADVICE_PHASES, phase = k % FBI_ADVICE_PHASES;
    status = fbi_advise_phase(work, &work->full, e, all, at, phase);
    fbi_copy(work->q_ddot[at][phase], work->motion.q_ddot, work->full.n);
    fbi_copy(work->displacement[at][phase], work->node.displacement, 3);
  }
  return status;
}

/* [E13.3] Relative error of the candidate in work.body by its missing effects, at most over load cases and phases: the
   difference of the output at the same coordinates (whole: only for a body with all modes), and E13.2 of the difference
   of its accelerations from those of the full set with all modes.
   Source: own.  Cost: 15 evaluations.  Fails: never (FB_HUGE: the motion cannot be evaluated).
   Test: sets_err_by_the_change_of_frequency. */
static fb_real fbi_advise_set(fb_advice_work *work, const fb_envelope *e, const int *coordinate, int whole)
{
  const int n = work->body.n;
  fb_real off[FB_MAX_MODES], q[FB_MAX_MODES], place = FB_R(0.0), motion = FB_R(0.0);
  for (int i = 0; i < FBI_ADVICE_INSTANTS * FBI_ADVICE_PHASES; i++) {
    const int at = i / FBI_ADVICE_PHASES, phase = i % FBI_ADVICE_PHASES;
    fb_real away[3];

    /* Error of the accelerations, as a static displacement of the output */
    fb_status status = fbi_advise_phase(work, &work->body, e, coordinate, at, phase);
    for (int k = 0; k < n && status == FB_OK; k++) {
      off[coordinate[k]] = work->motion.q_ddot[k] - work->q_ddot[at][phase][coordinate[k]];
    }
    status = status ? status : fbi_advise_solve(q, work, work->tangent[FBI_ADVICE_REST], off, n);
    if (status != FB_OK) {
      return FB_HUGE;
    }
    fbi_advice_output(away, work, e, q);
    motion = fbi_larger(motion, fbi_vec3_norm(away));

    /* Error of the displacement at the same coordinates */
    fbi_copy(away, work->node.displacement, 3);
    fbi_vec3_add(away, FB_R(-1.0), work->displacement[at][phase]);
    place = whole ? fbi_larger(place, fbi_vec3_norm(away)) : FB_R(0.0);
  }
  return place / work->deflection + fbi_advice_error(work, motion / work->deflection);
}

/* ---- cost and step of a candidate */

/* Approximate number of instructions of a step, so that the times of candidates have the right ratio: evaluations of
   the rates, solutions of the linear system of an implicit integrator, begin and end of the step, matrix and its LU
   factors. The linear system of a base that is not prescribed has 6 more rows.
   Source: counted, tests/reference/step_instructions.csv.  Fails: never.
   Test: costs_are_those_of_counted_instructions. */
static fb_real fbi_step_instructions(const fb_body *body, fb_integrator integrator)
{
  const fbi_integrator_traits *is = &fbi_integrator_table[(int)integrator];
  const int held = body->base == FB_BASE_PRESCRIBED;
  const fb_real n = (fb_real)body->n, quadratic = (fb_real)(body->n_S > 0),
                terms = (fb_real)(body->n_lambda + body->n_S);

  /* Counts of each part */
  const fb_real sums = 490 + 28 * n + 12 * terms;
  const fb_real rates = held ? sums + 390 * quadratic : FB_R(1.4) * sums + 1200 * quadratic - 20;
  const fb_real solve = held ? 460 + 255 * n : 1900 + 360 * n;
  const fb_real ends = held ? 250 + 90 * n : 150 + 30 * n; /* position of O, frame of the momenta */
  const fb_real factor = held ? 30 * terms + 130 * n : 85 * terms + 3900 + 830 * n;

  /* Stages of the integrator */
  const fb_real implicit = (fb_real)is->implicit;
  return (fb_real)is->evaluations * (rates + implicit * solve) + implicit * factor + is->own + is->own * n + ends;
}

/* Longest step considered [s]: the frame, else an eighth of the duration. */
static fb_real fbi_longest_step(const fb_envelope *e)
{
  return e->frame > FB_R(0.0) ? fbi_smaller(e->frame, e->duration) : FB_R(0.125) * e->duration;
}

/* Largest step [s] that an integrator accepts for the body in this envelope. */
static fb_real fbi_integrator_limit(const fb_body *body, fb_integrator integrator, const fb_envelope *e)
{
  const fb_real spin = fbi_vec3_norm(e->spin);
  const fb_real acceleration = body->base == FB_BASE_FREE ? FB_R(0.0) : fbi_vec3_norm(e->acceleration);
  return fbi_smaller(fbi_integrator_table[(int)integrator].limit(body, spin, acceleration), fbi_longest_step(e));
}

/* Largest step that divides the frame and is at most dt (dt <= frame). */
static fb_real fbi_frame_part(fb_real dt, fb_real frame)
{
  const fb_real parts = frame / dt;
  if (!(parts > FB_R(1.0) && parts < FB_R(1e6))) { /* no frame, one step, or too many to matter */
    return dt;
  }
  return frame / (fb_real)((long)parts + ((fb_real)(long)parts < parts));
}

/* Step [s] for a tolerance by E12.7: the free vibration of each mode at its frequency plus the spin, and the driven
   response at the frequency of the excitation. The exponential scheme is exact in its linear part; the error of the
   rest is that of rk4. */
static fb_real fbi_advice_step(fb_advice_work *work, const fb_envelope *e, fb_integrator integrator, int n,
                               fb_real tolerance)
{
  fb_spectrum *const s = &work->spectrum;
  const int exact = !fbi_has_amplification(integrator); /* in the linear part */
  const fb_real spin = fbi_vec3_norm(e->spin), inertial = exact ? work->error[0] : 1;
  fb_real amplitude[FB_MAX_MODES + 1];

  /* Free vibration */
  s->n = 0;
  for (int k = 0; k < n; k++) {
    const int a = work->order[k];
    amplitude[s->n] = inertial * work->most[a] / work->deflection * fbi_advice_share(work, e, a);
    s->re[s->n] = FB_R(0.0);
    s->im[s->n++] = work->omega[a] + spin;
  }

  /* Driven response */
  if (e->frequency < FB_HUGE && e->frequency > FB_R(0.0)) {
    amplitude[s->n] = inertial;
    s->re[s->n] = FB_R(0.0);
    s->im[s->n++] = e->frequency;
  }
  return fb_spectrum_dt(s, exact ? FB_INTEGRATOR_RK4 : integrator, amplitude, e->duration, tolerance);
}

/* ---- advice */

/* Modal responses, order of the modes, errors of all sets of effects and numbers of modes. */
static fb_status fbi_advise_prepare(fb_advice_work *work, const fb_shape *shape, const fb_body_desc *desc,
                                    const fb_envelope *e, fb_real tolerance)
{
  int all[FB_MAX_MODES];

  /* Bodies with all modes: full and linear set of effects */
  fb_status status = fbi_advise_check(shape, desc, e, tolerance);
  for (int a = 0; a < FB_MAX_MODES; a++) {
    all[a] = a;
    work->zeta[a] = fbi_has(desc->effects, FB_EFFECT_DAMPING) ? desc->zeta[a] : FB_R(0.0);
  }
  status = status ? status : fbi_advise_body(&work->full, work, shape, desc, NULL, FB_EFFECTS_FULL);
  status = status ? status : fbi_advise_body(&work->body, work, shape, desc, NULL, FB_EFFECTS_LINEAR);

  /* Modal responses in all load cases */
  status = status ? status : fbi_advise_answers(work, e);
  if (status == FB_OK && !(work->deflection > (FB_SINGLE ? FB_R(1e-6) : FB_R(1e-9)) * shape->size)) {
    status = FB_ERR_VALUE; /* nothing drives the output */
  }
  if (status == FB_OK) {
    fbi_advise_order(work, e);
    status = fbi_advise_full(work, e, all);
  }

  /* Errors by missing effects, then by missing modes */
  for (int set = 0; set < FBI_ADVICE_SETS && status == FB_OK; set++) {
    const int is = fbi_advise_body(&work->body, work, shape, desc, NULL, fbi_advice_set[set]) == FB_OK;
    work->error[set] = is ? fbi_advise_set(work, e, all, 1) : FB_HUGE; /* incomplete sets are refused */
  }
  for (int k = 0; k < shape->n && status == FB_OK; k++) {
    work->error_modes[k] = fbi_advise_modes(work, e, k + 1);
  }
  return status;
}

/* Effects, modes (in ascending order) and their errors of a candidate: the given set and the first n modes. */
static void fbi_advice_fill(fb_advice *advice, const fb_advice_work *work, const fb_body_desc *desc, int set, int n)
{
  memset(advice, 0, sizeof *advice);
  advice->effects = fbi_advice_set[set] | (desc->effects & (FB_EFFECT_DAMPING | FB_EFFECT_GRAVITY));
  advice->error_effects = work->error[set];
  advice->error_modes = work->error_modes[n - 1];
  advice->n = n;
  for (int k = 0; k < n; k++) {
    int at = k;
    for (; at > 0 && advice->coordinate[at - 1] > work->order[k]; at--) {
      advice->coordinate[at] = advice->coordinate[at - 1];
    }
    advice->coordinate[at] = work->order[k];
  }
}

/* Builds the body of a candidate in work.body; FB_ERR_EFFECTS: the set is not possible. */
static fb_status fbi_candidate(fb_advice_work *work, const fb_shape *shape, const fb_body_desc *desc,
                               const fb_advice *advice)
{
  const fb_status status = fb_shape_select(&work->shape, shape, advice->coordinate, advice->n);
  return status ? status
                : fbi_advise_body(&work->body, work, &work->shape, desc, advice->coordinate,
                                  advice->effects & FB_EFFECTS_FULL);
}

/* [E13.4] Relative error of every modal body, by the energies above degree 2 in q that it leaves out. The tip of a beam
   bent by delta moves inward by 1.2 delta^2/2L (foreshortening); the speed of that times the spin w is an acceleration
   that the model lacks, a part r = 1.2 (delta/L) |w| rate/omega^2 of the load that bends the beam. In addition
   0.3 (delta/L)^2, growing with a quarter of the phase of the free vibration, since amplitudes are seldom the largest.
   Source: own; the 0.3 and the quarter fitted to simulations of the exact beam.  Fails: never.
   Test: advice_knows_where_modes_end. */
static fb_real fbi_advice_model_error(const fb_advice_work *work, const fb_shape *shape)
{
  const fb_real bend = work->bend / shape->size;
  const fb_real phase = FB_R(0.3) * bend * bend * (FB_R(1.0) + FB_R(0.25) * work->ringing);
  return work->buckled ? FB_HUGE : fbi_smaller(FB_R(1.2) * work->drawn / shape->size + phase, FB_HUGE);
}

/* Integrator and step with the least cost within `tolerance`, what effects and modes have left. */
static void fbi_advise_integrator(fb_advice *advice, fb_advice_work *work, const fb_envelope *e, fb_real tolerance)
{
  advice->cost = FB_HUGE;
  for (int s = 0; s < (int)FB_INTEGRATOR_COUNT; s++) {
    const fb_integrator integrator = (fb_integrator)s;
    const fb_real limit = fbi_integrator_limit(&work->body, integrator, e);
    const fb_real step = fbi_advice_step(work, e, integrator, advice->n, tolerance);
    const fb_real dt = fbi_frame_part(fbi_smaller(limit, step), e->frame);
    const fb_real cost = fbi_step_instructions(&work->body, integrator) / dt;
    if (step > FB_R(0.0) && limit > FB_R(0.0) && cost < advice->cost) {
      advice->integrator = integrator;
      advice->dt = dt;
      advice->cost = cost;
    }
  }
  advice->error_step = tolerance;
}

/* Adds the estimates that do not depend on the candidate, and the sum of its errors. */
static void fbi_advice_finish(fb_advice *advice, const fb_advice_work *work, const fb_shape *shape)
{
  for (int i = 0; i < FB_ADVICE_EFFECTS; i++) {
    advice->without[i] = i == 0 ? FB_R(1.0) : FB_HUGE; /* a rigid body has no elastic displacement */
    for (int set = 0; set < FBI_ADVICE_SETS && i > 0; set++) {
      if (!(fbi_advice_set[set] & 1u << i)) {
        advice->without[i] = fbi_smaller(advice->without[i], work->error[set]);
      }
    }
  }
  advice->deflection = work->deflection;
  advice->error_model = fbi_advice_model_error(work, shape);
  advice->error = advice->error_effects + advice->error_modes + advice->error_step + advice->error_model;
}

FB_DEF fb_status fb_advice_solve(fb_advice *advice, fb_advice_work *work, const fb_shape *shape,
                                 const fb_body_desc *desc, const fb_envelope *envelope, fb_real tolerance)
{
  fb_advice best, candidate;
  fb_real left; /* tolerance less the error of every modal body, at least half of it */
  fb_status status;

  /* Responses and error estimates */
  FBI_REQUIRE(advice && work && shape && desc && envelope, FB_ERR_NULL);
  status = fbi_advise_prepare(work, shape, desc, envelope, tolerance);
  if (status != FB_OK) {
    return status;
  }

  /* The cheapest candidate whose errors add up to the tolerance */
  best.cost = FB_HUGE;
  left = tolerance - fbi_smaller(fbi_advice_model_error(work, shape), FB_R(0.5) * tolerance);
  for (int k = 0; k < FBI_ADVICE_SETS * shape->n; k++) {
    const int set = k / shape->n, n = 1 + k % shape->n;
    fb_real rest = left - work->error[set] - work->error_modes[n - 1], own;
    fbi_advice_fill(&candidate, work, desc, set, n);
    if (rest > FB_R(0.0) && fbi_candidate(work, shape, desc, &candidate) == FB_OK) {
      own = fbi_advise_set(work, envelope, candidate.coordinate, 0);
      candidate.error_effects = fbi_larger(candidate.error_effects, own);
      rest = left - candidate.error_effects - candidate.error_modes;
      if (rest > FB_R(0.0)) {
        fbi_advise_integrator(&candidate, work, envelope, rest);
        best = candidate.cost < best.cost ? candidate : best;
      }
    }
  }
  if (!(best.cost < FB_HUGE)) {
    return FB_ERR_STEP;
  }
  fbi_advice_finish(&best, work, shape);
  *advice = best;
  return FB_OK;
}

/* ---- search by simulation */

/* Trial step number `part` of a candidate: the longest step divided by sqrt(2)^part, rounded to a whole part of the
   frame. */
static fb_real fbi_trial_step(fb_real longest, fb_real frame, int part)
{
  fb_real ratio = FB_R(1.0);
  for (int k = 0; k < part; k++) {
    ratio *= FB_R(1.41421356237309505);
  }
  return fbi_smaller(longest, fbi_frame_part(longest / ratio * (FB_R(1.0) + FBI_ROUNDING), frame));
}

/* Costs and longest steps of all candidates; impossible ones get no trial steps. */
static fb_status fbi_search_prepare(fb_advice_work *work, const fb_shape *shape, const fb_body_desc *desc,
                                    const fb_envelope *e)
{
  fb_advice candidate;
  for (int k = 0; k < FBI_ADVICE_SETS * shape->n; k++) {
    const int set = k / shape->n, i = k % shape->n;
    fb_status status;
    fbi_advice_fill(&candidate, work, desc, set, i + 1);
    status = fbi_candidate(work, shape, desc, &candidate);
    if (status != FB_OK && status != FB_ERR_EFFECTS) {
      return status;
    }
    for (int s = 0; s < (int)FB_INTEGRATOR_COUNT; s++) {
      const fb_integrator integrator = (fb_integrator)s;
      work->last[set][i][s] = FB_HUGE;
      work->part[set][i][s] = status == FB_OK ? 0 : FBI_ADVICE_PARTS;
      work->step_cost[set][i][s] = status == FB_OK ? fbi_step_instructions(&work->body, integrator) : FB_R(0.0);
      work->longest[set][i][s] =
          fbi_integrator_table[s].bounded ? fbi_integrator_limit(&work->body, integrator, e) : fbi_longest_step(e);
    }
  }
  return FB_OK;
}

/* Finds the cheapest candidate (set, number of modes - 1, integrator) not yet simulated; 0: none is left. */
static int fbi_search_next(int at[3], fb_advice *advice, const fb_advice_work *work, const fb_envelope *e, int n)
{
  fb_real best = FB_HUGE;
  const int count = (int)FB_INTEGRATOR_COUNT;
  for (int k = 0; k < FBI_ADVICE_SETS * n * count; k++) {
    const int set = k / (count * n), i = k / count % n, s = k % count;
    if (work->part[set][i][s] < FBI_ADVICE_PARTS && work->longest[set][i][s] > FB_R(0.0)) {
      const fb_real dt = fbi_trial_step(work->longest[set][i][s], e->frame, work->part[set][i][s]);
      const fb_real cost = work->step_cost[set][i][s] / dt;
      if (cost < best) {
        best = cost;
        at[0] = set;
        at[1] = i;
        at[2] = s;
        advice->dt = dt;
        advice->cost = cost;
      }
    }
  }
  return best < FB_HUGE;
}

/* Norm of the largest sample of a, or of a - b; FB_HUGE if one is not finite. */
static fb_real fbi_trial_largest(const fb_trial *trial, const fb_real *a, const fb_real *b)
{
  fb_real most = FB_R(0.0), sum = FB_R(0.0);
  for (int k = 0; k < trial->n; k++) {
    const fb_real d = a[k] - (b ? b[k] : FB_R(0.0));
    sum = k % trial->width == 0 ? d * d : sum + d * d;
    if (!(sum < FB_HUGE)) {
      return FB_HUGE;
    }
    most = fbi_larger(most, sum);
  }
  return FB_SQRT(most);
}

static fb_real fbi_trial_error(const fb_trial *trial)
{
  const fb_real most = fbi_trial_largest(trial, trial->output, trial->reference);
  return most < FB_HUGE ? most / fbi_trial_largest(trial, trial->reference, NULL) : FB_HUGE;
}

#define FBI_ADVICE_SHORT 4 /* trial step of the reference: a quarter of the limit of rk4 */
/* Records the error of a simulated candidate: its next trial step is shorter. Where the error no longer depends on the
   step, effects and modes cause it, and no integrator is tried with them any more. */
static void fbi_search_note(fb_advice_work *work, const fb_envelope *e, const int at[3], fb_real error,
                            fb_real tolerance)
{
  int *const part = work->part[at[0]][at[1]];
  fb_real *const last = &work->last[at[0]][at[1]][at[2]];
  const fb_real longest = work->longest[at[0]][at[1]][at[2]], dt = fbi_trial_step(longest, e->frame, part[at[2]]);
  const int same = error < FB_R(0.5) && FB_FABS(error - *last) < FB_R(0.05) * error;
  do { /* the next different step; rounded to parts of the frame, some are equal */
    part[at[2]]++;
  } while (part[at[2]] < FBI_ADVICE_PARTS && !(fbi_trial_step(longest, e->frame, part[at[2]]) < FB_R(0.999) * dt));
  for (int s = 0; s < (int)FB_INTEGRATOR_COUNT && same && error > FB_R(1.2) * tolerance; s++) {
    part[s] = FBI_ADVICE_PARTS;
  }
  *last = error;
}

/* Simulates all modes and effects with a short step: the reference, or its error against a given one. Its cost is the
   upper bound of the search. */
static fb_status fbi_search_fullest(fb_advice *fullest, fb_advice_work *work, const fb_shape *shape,
                                    const fb_body_desc *desc, const fb_envelope *e, const fb_trial *trial)
{
  const int n = shape->n;
  fb_real size;
  fb_status status;
  fbi_advice_fill(fullest, work, desc, FBI_ADVICE_FULL, n);
  fullest->dt = fbi_trial_step(work->longest[FBI_ADVICE_FULL][n - 1][FB_INTEGRATOR_RK4], e->frame, FBI_ADVICE_SHORT);
  fullest->cost = work->step_cost[FBI_ADVICE_FULL][n - 1][FB_INTEGRATOR_RK4] / fullest->dt;
  if (!(fullest->dt > FB_R(0.0)) || !(fullest->cost < FB_HUGE)) {
    return FB_ERR_STEP;
  }
  status = trial->run(trial->user, trial->has_reference ? trial->output : trial->reference, fullest);
  size = fbi_trial_largest(trial, trial->reference, NULL);
  if (status == FB_OK && !(size > FB_R(0.0) && size < FB_HUGE)) { /* errors are relative to it */
    status = size > FB_R(0.0) ? FB_ERR_NOT_FINITE : FB_ERR_VALUE;
  }
  fullest->error = status == FB_OK && trial->has_reference ? fbi_trial_error(trial) : FB_R(0.0);
  return status;
}

/* Simulates candidates in the order of their cost, up to `most`; FB_ERR_CONVERGENCE: none meets the tolerance. */
static fb_status fbi_search_run(fb_advice *found, fb_advice_work *work, const fb_body_desc *desc, const fb_envelope *e,
                                fb_real tolerance, const fb_trial *trial, fb_real most)
{
  int at[3] = {0, 0, 0}, n_trial = 1;
  fb_advice next;
  memset(&next, 0, sizeof next);
  while (fbi_search_next(at, &next, work, e, work->full.n) && next.cost <= most) {
    fbi_advice_fill(found, work, desc, at[0], at[1] + 1);
    found->dt = next.dt;
    found->cost = next.cost;
    found->integrator = (fb_integrator)at[2];
    found->n_trial = ++n_trial;
    found->error = trial->run(trial->user, trial->output, found) == FB_OK ? fbi_trial_error(trial) : FB_HUGE;
    if (found->error <= tolerance) {
      return FB_OK;
    }
    fbi_search_note(work, e, at, found->error, tolerance);
  }
  return FB_ERR_CONVERGENCE;
}

FB_DEF fb_status fb_advice_search(fb_advice *advice, fb_advice_work *work, const fb_shape *shape,
                                  const fb_body_desc *desc, const fb_envelope *envelope, fb_real tolerance,
                                  const fb_trial *trial)
{
  fb_advice found;
  fb_status status;
  FBI_REQUIRE(advice && work && shape && desc && envelope && trial, FB_ERR_NULL);
  FBI_REQUIRE(trial->run && trial->output && trial->reference, FB_ERR_NULL);
  FBI_REQUIRE(trial->n > 0 && trial->width > 0 && trial->n % trial->width == 0, FB_ERR_VALUE);

  /* Estimates, then the reference */
  status = fbi_advise_prepare(work, shape, desc, envelope, tolerance);
  status = status ? status : fbi_search_prepare(work, shape, desc, envelope);
  status = status ? status : fbi_search_fullest(&found, work, shape, desc, envelope, trial);
  if (status == FB_OK && found.error > 2 * tolerance) { /* with fewer effects it could be smaller by chance only */
    status = FB_ERR_CONVERGENCE;
  }

  /* Candidates, the cheapest first */
  status = status ? status : fbi_search_run(&found, work, desc, envelope, tolerance, trial, found.cost);

  /* The estimates beside the error found */
  if (status == FB_OK) {
    const fb_real error = found.error;
    fbi_advice_finish(&found, work, shape);
    found.error = error;
    status = fbi_candidate(work, shape, desc, &found);
  }
  if (status == FB_OK) {
    found.long_step = found.dt > fbi_integrator_limit(&work->body, found.integrator, envelope);
    *advice = found;
  }
  return status;
}
#endif /* FB_WITH_ANALYSE */
