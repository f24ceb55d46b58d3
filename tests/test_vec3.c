/* >>vec3: 3-vectors, 3x3 and symmetric 6x6 matrices, against the sums written out in long double. */
#include "fbt.h"

static long double dot_of(const fb_real *a, const fb_real *b, int n, int stride)
{
  long double sum = 0.0L;
  for (int i = 0; i < n; i++) {
    sum += (long double)a[i] * (long double)b[i * stride];
  }
  return sum;
}

/* E3.3: e_x x e_y = e_z, and the identities of Lagrange and Jacobi. */
TEST(cross_and_dot_products_keep_their_identities)
{
  const double tol = 16.0 * FBT_TOL(2.3e-16, 1.2e-7);
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      fb_real a[3] = {0}, b[3] = {0}, c[3] = {9, 9, 9};
      const int sign = j == (i + 1) % 3 ? 1 : i == (j + 1) % 3 ? -1 : 0;
      a[i] = b[j] = FB_R(1.0);
      fb_vec3_cross(c, a, b);
      FBT_NEAR_ABS(fb_vec3_dot(a, b), i == j, 0.0);
      for (int k = 0; k < 3; k++) {
        FBT_NEAR_ABS(c[k], k != i && k != j ? sign : 0, 0.0);
      }
    }
  }
  for (int trial = 0; trial < 100; trial++) {
    fb_real a[3], b[3], c[3], ab[3], ba[3], bc[3], ca[3], x[3], y[3], z[3];
    fbt_fill(a, 3, 1.0);
    fbt_fill(b, 3, 1.0);
    fbt_fill(c, 3, 1.0);
    fb_vec3_cross(ab, a, b);
    fb_vec3_cross(ba, b, a);
    fb_vec3_cross(bc, b, c);
    fb_vec3_cross(ca, c, a);
    fb_vec3_cross(x, a, bc);
    fb_vec3_cross(y, b, ca);
    fb_vec3_cross(z, c, ab);
    FBT_NEAR_ABS(fb_vec3_dot(a, b), (double)dot_of(a, b, 3, 1), tol);
    FBT_NEAR_ABS(fb_vec3_dot(a, ab), 0.0, tol);
    FBT_NEAR_ABS(fb_vec3_dot(a, bc), fb_vec3_dot(c, ab), tol);
    FBT_NEAR_ABS(fb_vec3_dot(ab, ab) + fb_vec3_dot(a, b) * fb_vec3_dot(a, b), fb_vec3_dot(a, a) * fb_vec3_dot(b, b),
                 tol);
    for (int k = 0; k < 3; k++) {
      FBT_NEAR_ABS(ab[k], -ba[k], tol);
      FBT_NEAR_ABS(x[k] + y[k] + z[k], 0.0, tol);
      FBT_NEAR_ABS(x[k], b[k] * fb_vec3_dot(a, c) - c[k] * fb_vec3_dot(a, b), tol);
    }
  }
}

/* E3.3: rows times columns; (A B) x = A (B x); y.(A x) = (A^T y).x. */
TEST(matrix_products_agree_with_their_definition)
{
  const double tol = 32.0 * FBT_TOL(2.3e-16, 1.2e-7);
  for (int trial = 0; trial < 100; trial++) {
    fb_real A[9], B[9], C[9], x[3], y[3], Ax[3], ATy[3], Bx[3], ABx[3], Cx[3];
    fbt_fill(A, 9, 1.0);
    fbt_fill(B, 9, 1.0);
    fbt_fill(x, 3, 1.0);
    fbt_fill(y, 3, 1.0);
    fb_mat33_mul(C, A, B);
    fb_mat33_mul_vec3(Ax, A, x);
    fb_mat33_mulT_vec3(ATy, A, y);
    fb_mat33_mul_vec3(Bx, B, x);
    fb_mat33_mul_vec3(ABx, A, Bx);
    fb_mat33_mul_vec3(Cx, C, x);
    FBT_NEAR_ABS(fb_vec3_dot(y, Ax), fb_vec3_dot(ATy, x), tol);
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(Ax[i], (double)dot_of(A + 3 * i, x, 3, 1), tol);
      FBT_NEAR_ABS(ATy[i], (double)dot_of(y, A + i, 3, 3), tol);
      FBT_NEAR_ABS(Cx[i], ABx[i], tol);
      for (int j = 0; j < 3; j++) {
        FBT_NEAR_ABS(C[3 * i + j], (double)dot_of(A + 3 * i, B + j, 3, 3), tol);
      }
    }
  }
}

/* Interface: (0,0), (0,1) .. (0,5), (1,1) .. (5,5), the same both ways round. */
TEST(sym6_is_packed_by_the_upper_triangle)
{
  int next = 0;
  for (int i = 0; i < 6; i++) {
    for (int j = i; j < 6; j++, next++) {
      FBT_INT_EQ(fb_sym6_index(i, j), next);
      FBT_INT_EQ(fb_sym6_index(j, i), next);
    }
  }
  FBT_INT_EQ(next, 21);
  for (int trial = 0; trial < 100; trial++) {
    fb_real S[21], full[36], x[6], y[6];
    fbt_fill(S, 21, 1.0);
    fbt_fill(x, 6, 1.0);
    next = 0;
    for (int i = 0; i < 6; i++) {
      for (int j = i; j < 6; j++, next++) {
        full[6 * i + j] = full[6 * j + i] = S[next];
      }
    }
    fb_sym6_mul_vec6(y, S, x);
    for (int i = 0; i < 6; i++) {
      FBT_NEAR_ABS(y[i], (double)dot_of(full + 6 * i, x, 6, 1), 16.0 * FBT_TOL(2.3e-16, 1.2e-7));
    }
  }
}

/* S = sum over count vectors of b b^T, scaled by D S D; integers: entries -2..2, so that S is exact. Row and column
   copy (if >= 0) are twice those of the row before it: singular. */
static void sym6_random(fb_real S[21], int count, int integers, int copy, const fb_real D[6])
{
  memset(S, 0, sizeof(fb_real) * 21);
  for (int k = 0; k < count; k++) {
    fb_real b[6];
    fbt_fill(b, 6, 1.0);
    for (int i = 0; i < 6; i++) {
      b[i] = integers ? (fb_real)(int)(2.999 * (double)b[i]) : b[i];
    }
    if (copy >= 0) {
      b[copy] = FB_R(2.0) * b[(copy + 5) % 6];
    }
    for (int i = 0; i < 6; i++) {
      for (int j = 0; j <= i; j++) {
        S[fb_sym6_index(i, j)] += b[i] * b[j];
      }
    }
  }
  for (int i = 0; i < 6; i++) {
    for (int j = 0; j <= i; j++) {
      S[fb_sym6_index(i, j)] *= D[i] * D[j];
    }
  }
}

/* Grading 10^(-spread) .. 1 of the diagonal of S in random order, rounded to powers of two: D S D is exact. */
static void grading_random(fb_real D[6], double spread)
{
  for (int i = 0; i < 6; i++) {
    D[i] = (fb_real)ldexp(1.0, (int)(-0.5 * spread * 3.3219 * (i / 5.0)));
  }
  for (int i = 5; i > 0; i--) {
    const int j = (int)((i + 1) * 0.5 * (1.0 + fbt_random()));
    const fb_real t = D[i];
    D[i] = D[j];
    D[j] = t;
  }
}

/* Largest |S x - y|_i / sum_j sqrt(S_ii S_jj) |x_j|: the backward error of Cholesky, unmoved by scaling. */
static double sym6_residual(const fb_real S[21], const fb_real x[6], const fb_real y[6])
{
  double worst = 0.0;
  for (int i = 0; i < 6; i++) {
    long double r = -(long double)y[i], size = 0.0L;
    for (int j = 0; j < 6; j++) {
      const int ij = fb_sym6_index(i, j), ii = fb_sym6_index(i, i), jj = fb_sym6_index(j, j);
      r += (long double)S[ij] * (long double)x[j];
      size += sqrtl((long double)S[ii] * (long double)S[jj]) * fabsl((long double)x[j]);
    }
    worst = fmax(worst, (double)(fabsl(r) / size));
  }
  return worst;
}

static void sym6_refused(const fb_real S[21])
{
  const fb_real before[6] = {1, -2, 3, -4, 5, -6};
  fb_real x[6];
  memcpy(x, before, sizeof x);
  FBT_INT_EQ(fb_sym6_solve(x, S, before), FB_ERR_SINGULAR);
  FBT_TRUE(memcmp(x, before, sizeof x) == 0);
  FBT_INT_EQ(fb_sym6_solve(x, S, x), FB_ERR_SINGULAR);
  FBT_TRUE(memcmp(x, before, sizeof x) == 0);
}

/* E3.1: backward stable for random and graded matrices (condition of D S D beyond 1e12); singular, indefinite and NaN
   are refused. The bound, 3 epsilon, is a third of the proven one, (3 n + 1) epsilon / 2 [GV] 4.2.6. */
TEST(sym6_solve_inverts_random_and_graded_matrices)
{
  static const fb_real ones[6] = {1, 1, 1, 1, 1, 1};
  const double unit = FBT_TOL(2.2204460492503131e-16, 1.19209290e-7);
  double worst = 0.0;
  for (int trial = 0; trial < 2000; trial++) {
    fb_real S[21], D[6], x[6], y[6], z[6];
    grading_random(D, trial % 2 ? 12.0 : 0.0);
    sym6_random(S, 8, 0, -1, D);
    fbt_fill(y, 6, 1.0);
    FBT_INT_EQ(fb_sym6_solve(x, S, y), FB_OK);
    worst = fmax(worst, sym6_residual(S, x, y) / unit);
    memcpy(z, y, sizeof z);
    FBT_INT_EQ(fb_sym6_solve(z, S, z), FB_OK); /* in place: the same bits */
    FBT_TRUE(memcmp(x, z, sizeof x) == 0);
  }
  FBT_BELOW(worst, 3.0);
  for (int trial = 0; trial < 2000; trial++) {
    fb_real S[21], D[6];
    grading_random(D, trial % 2 ? 12.0 : 0.0);
    sym6_random(S, 1 + trial % 3, 1, -1, D); /* rank 1 to 3 */
    sym6_refused(S);
    sym6_random(S, 8, 1, trial % 6, D); /* rank 5 */
    sym6_refused(S);
    sym6_random(S, 8, 0, -1, D);
    S[fb_sym6_index(trial % 6, trial % 6)] *= -FB_R(1.0);
    sym6_refused(S);
  }
  for (int i = 0; i < 6; i++) {
    for (int j = i + 1; j < 6; j++) { /* [1 2; 2 1] in rows i and j */
      fb_real S[21] = {0};
      for (int k = 0; k < 6; k++) {
        S[fb_sym6_index(k, k)] = FB_R(1.0);
      }
      S[fb_sym6_index(i, j)] = FB_R(2.0);
      sym6_refused(S);
    }
  }
  for (int k = 0; k < 21; k++) {
    fb_real S[21];
    sym6_random(S, 8, 0, -1, ones);
    S[k] = (fb_real)NAN;
    sym6_refused(S);
    S[k] = (fb_real)INFINITY;
    sym6_refused(S);
  }
}

SUITE(vec3, RUN(cross_and_dot_products_keep_their_identities), RUN(matrix_products_agree_with_their_definition),
      RUN(sym6_is_packed_by_the_upper_triangle), RUN(sym6_solve_inverts_random_and_graded_matrices))
