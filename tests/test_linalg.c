/* >>solve and >>eigen: LU, Cholesky, symmetric and generalized eigenvalues. Residuals are sums in long double, in units
   of the epsilon of fb_real. Graded: D1 A D2 with diagonals of powers of two from 1 to 1e-6 in random order, so that
   row and column scaling together raise the condition number by 1e12, the same in both precisions (LU: columns to
   1e-18, single precision 1e-9: beyond rounding). */
#include "fbt.h"

#define EPS FBT_TOL(2.2204460492503131e-16, 1.19209290e-7)
#define MAX_SIZE 40
static const int size[] = {1, 2, 5, 12, 40};

typedef fb_real matrix[MAX_SIZE * MAX_SIZE];
static matrix A, B, F, V, K, M;
static fb_real d[MAX_SIZE], D1[MAX_SIZE], D2[MAX_SIZE], x[MAX_SIZE], b[MAX_SIZE], scratch[MAX_SIZE];
static int perm[MAX_SIZE];

/* Powers of two from 1 down to 2^-span in random order. */
static void grading_random(fb_real *D, int n, int span)
{
  for (int i = 0; i < n; i++) {
    D[i] = (fb_real)ldexp(1.0, n > 1 ? -(span * i) / (n - 1) : 0);
  }
  for (int i = n - 1; i > 0; i--) {
    const int j = (int)((i + 1) * 0.5 * (1.0 + fbt_random()));
    const fb_real t = D[i];
    D[i] = D[j];
    D[j] = t;
  }
}

/* X = D1 X D2 */
static void matrix_scale(fb_real *X, const fb_real *left, const fb_real *right, int n)
{
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) {
      X[i * n + j] *= left[i] * right[j];
    }
  }
}

/* X = B B^T with B n x count, random; integers: entries -2..2, X exact. */
static void gram_random(fb_real *X, int n, int count, int integers)
{
  memset(X, 0, sizeof(fb_real) * (size_t)(n * n));
  for (int k = 0; k < count; k++) {
    fbt_fill(scratch, n, 1.0);
    for (int i = 0; i < n; i++) {
      scratch[i] = integers ? (fb_real)(int)(2.999 * (double)scratch[i]) : scratch[i];
      for (int j = 0; j <= i; j++) {
        X[i * n + j] += scratch[i] * scratch[j];
        X[j * n + i] = X[i * n + j];
      }
    }
  }
}

static void symmetric_random(fb_real *X, int n)
{
  fbt_fill(X, n * n, 1.0);
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < i; j++) {
      X[i * n + j] = X[j * n + i];
    }
  }
}

/* n x n integers of rank at most n - 1: kind 0 a zero row, 1 a zero column, 2 a row that is twice another, 3 a column
   that is, 4 rank n/2. */
static void singular_random(fb_real *X, int n, int kind, int r)
{
  const int q = (r + 1) % n;
  for (int i = 0; i < n * n; i++) {
    X[i] = (fb_real)(int)(4.999 * fbt_random());
  }
  for (int j = 0; j < n; j++) {
    if (kind == 0 || kind == 2) {
      X[r * n + j] = kind == 2 && n > 1 ? FB_R(2.0) * X[q * n + j] : FB_R(0.0);
    } else if (kind == 1 || kind == 3) {
      X[j * n + r] = kind == 3 && n > 1 ? FB_R(2.0) * X[j * n + q] : FB_R(0.0);
    }
  }
  if (kind == 4) {
    memset(X, 0, sizeof(fb_real) * (size_t)(n * n));
    for (int k = 0; k < n / 2; k++) {
      for (int i = 0; i < n; i++) {
        x[i] = (fb_real)(int)(2.999 * fbt_random());
        b[i] = (fb_real)(int)(2.999 * fbt_random());
      }
      for (int i = 0; i < n * n; i++) {
        X[i] += x[i / n] * b[i % n];
      }
    }
  }
}

static void copy(fb_real *y, const fb_real *source, int n)
{
  memcpy(y, source, sizeof(fb_real) * (size_t)n);
}

/* max_i |A x - b|_i / (|A| |x| + |b|)_i in epsilon: the componentwise backward error (Oettli and Prager). */
static double backward_error(const fb_real *X, const fb_real *y, const fb_real *rhs, int n)
{
  double worst = 0.0;
  for (int i = 0; i < n; i++) {
    long double r = -(long double)rhs[i], sum = fabsl(r);
    for (int j = 0; j < n; j++) {
      const long double t = (long double)X[i * n + j] * (long double)y[j];
      r += t;
      sum += fabsl(t);
    }
    worst = fmax(worst, (double)(fabsl(r) / sum));
  }
  return worst / EPS;
}

/* A non-finite element anywhere, or one whose square overflows, is noticed: solve gets A in F. */
static void non_finite_is_refused(fb_status (*solve)(int n), int n, int lower_only)
{
  const fb_real bad[3] = {(fb_real)NAN, (fb_real)INFINITY, -(fb_real)INFINITY};
  for (int at = 0; at<n * n; at += n> 12 ? 37 : 1) {
    const int i = at / n, j = at % n;
    for (int k = 0; k < 3 && !(lower_only && j > i); k++) {
      copy(F, A, n * n);
      F[at] = F[j * n + i] = bad[k];
      FBT_INT_EQ(solve(n), FB_ERR_NOT_FINITE);
    }
  }
}

static fb_status lu_of_F(int n)
{
  return fb_lu_factor(F, perm, scratch, n);
}

/* E5.1: componentwise backward error of random and graded systems below 2 (n + 1) epsilon; units of the rows (powers
   of two) change neither the pivoting nor a bit of the solution; what is singular or not finite is refused. */
TEST(lu_solves_random_graded_and_refuses_singular_matrices)
{
  for (int s = 0; s < FBT_COUNT(size); s++) {
    const int n = size[s];
    for (int trial = 0; trial < 40; trial++) {
      fb_real y[MAX_SIZE];
      int other[MAX_SIZE];
      fbt_fill(A, n * n, 1.0);
      fbt_fill(b, n, 1.0);
      grading_random(D1, n, trial % 2 ? 20 : 0);
      grading_random(D2, n, trial % 2 ? (int)FBT_TOL(60, 30) : 0);
      matrix_scale(A, D1, D2, n);
      copy(F, A, n * n);
      FBT_INT_EQ(fb_lu_factor(F, perm, scratch, n), FB_OK);
      fb_lu_solve(x, F, perm, b, n);
      FBT_BELOW(backward_error(A, x, b, n), 2.0 * (n + 1));
      grading_random(D1, n, 40);
      grading_random(D2, n, 0);
      copy(F, A, n * n);
      matrix_scale(F, D1, D2, n);
      for (int i = 0; i < n; i++) {
        b[i] *= D1[i];
      }
      FBT_INT_EQ(fb_lu_factor(F, other, scratch, n), FB_OK);
      fb_lu_solve(y, F, other, b, n);
      FBT_TRUE(memcmp(perm, other, sizeof(int) * (size_t)n) == 0);
      FBT_TRUE(memcmp(x, y, sizeof(fb_real) * (size_t)n) == 0);
    }
    for (int trial = 0; trial < 100; trial++) {
      singular_random(F, n, trial % 5, trial % n);
      grading_random(D1, n, trial % 2 ? 20 : 0);
      grading_random(D2, n, trial % 2 ? 20 : 0);
      matrix_scale(F, D1, D2, n);
      FBT_INT_EQ(fb_lu_factor(F, perm, scratch, n), FB_ERR_SINGULAR);
    }
    fbt_fill(A, n * n, 1.0);
    non_finite_is_refused(lu_of_F, n, 0);
  }
  FBT_INT_EQ(fb_lu_factor(NULL, perm, scratch, 1), FB_ERR_NULL);
  FBT_INT_EQ(fb_lu_factor(F, NULL, scratch, 1), FB_ERR_NULL);
  FBT_INT_EQ(fb_lu_factor(F, perm, NULL, 1), FB_ERR_NULL);
  FBT_INT_EQ(fb_lu_factor(F, perm, scratch, -1), FB_ERR_VALUE);
  FBT_INT_EQ(fb_lu_factor(F, perm, scratch, 0), FB_OK);
}

static fb_status chol_of_F(int n)
{
  return fb_chol_factor(F, n);
}

/* max |A - L L^T|_ij / sqrt(A_ii A_jj), and of the solution |A x - b|_i / sum_j sqrt(A_ii A_jj) |x_j|, in epsilon. */
static double cholesky_error(const fb_real *X, const fb_real *L, const fb_real *y, const fb_real *rhs, int n)
{
  double worst = 0.0;
  for (int i = 0; i < n; i++) {
    long double residual = -(long double)rhs[i], sum = 0.0L;
    for (int j = 0; j < n; j++) {
      const long double s = sqrtl((long double)X[i * n + i] * (long double)X[j * n + j]);
      long double r = (long double)X[i * n + j];
      for (int k = 0; k <= (i < j ? i : j); k++) {
        r -= (long double)L[i * n + k] * (long double)L[j * n + k];
      }
      worst = fmax(worst, (double)(fabsl(r) / s));
      residual += (long double)X[i * n + j] * (long double)y[j];
      sum += s * fabsl((long double)y[j]);
    }
    worst = fmax(worst, (double)(fabsl(residual) / sum));
  }
  return worst / EPS;
}

/* E5.2: factors and solutions of random and graded matrices to (n + 2)/2 epsilon, half of what [GV] 4.2.6 proves;
   only the lower triangle is read and written; in place, the same bits; what is not positive definite or finite is
   refused. */
TEST(cholesky_factors_graded_and_refuses_indefinite_matrices)
{
  for (int s = 0; s < FBT_COUNT(size); s++) {
    const int n = size[s];
    for (int trial = 0; trial < 40; trial++) {
      gram_random(A, n, n + 2, 0);
      grading_random(D1, n, trial % 2 ? 20 : 0);
      matrix_scale(A, D1, D1, n);
      fbt_fill(b, n, 1.0);
      copy(F, A, n * n);
      for (int i = 0; i < n; i++) {
        for (int j = i + 1; j < n; j++) {
          F[i * n + j] = (fb_real)NAN;
        }
      }
      FBT_INT_EQ(fb_chol_factor(F, n), FB_OK);
      for (int i = 0; i < n; i++) {
        for (int j = i + 1; j < n; j++) {
          FBT_TRUE(F[i * n + j] != F[i * n + j]);
        }
      }
      fb_chol_solve(x, F, b, n);
      FBT_BELOW(cholesky_error(A, F, x, b, n), 0.5 * (n + 2));
      fb_chol_solve(b, F, b, n);
      FBT_TRUE(memcmp(b, x, sizeof(fb_real) * (size_t)n) == 0);
    }
    for (int trial = 0; trial < 100; trial++) {
      const int r = trial % n, q = (r + 1) % n;
      gram_random(F, n, n / 2, 1); /* rank n/2 */
      grading_random(D1, n, trial % 2 ? 20 : 0);
      matrix_scale(F, D1, D1, n);
      FBT_INT_EQ(fb_chol_factor(F, n), FB_ERR_SINGULAR);
      gram_random(F, n, 2 * n, 1); /* row and column r as q, or zero */
      for (int k = 0; k < 2; k++) {
        for (int j = 0; j < n; j++) {
          F[k ? j * n + r : r * n + j] = r != q ? F[k ? j * n + q : q * n + j] : FB_R(0.0);
        }
      }
      matrix_scale(F, D1, D1, n);
      FBT_INT_EQ(fb_chol_factor(F, n), FB_ERR_SINGULAR);
      gram_random(F, n, n + 2, 0); /* indefinite: a negative diagonal element, or an overgrown pair */
      F[r * n + r] = -F[r * n + r];
      FBT_INT_EQ(fb_chol_factor(F, n), FB_ERR_SINGULAR);
      if (n > 1) {
        gram_random(F, n, n + 2, 0);
        F[r * n + q] = F[q * n + r] = (fb_real)(1.1 * sqrt((double)F[r * n + r] * (double)F[q * n + q]));
        FBT_INT_EQ(fb_chol_factor(F, n), FB_ERR_SINGULAR);
      }
    }
    gram_random(A, n, n + 2, 0);
    for (int i = 0; i < n; i++) {
      A[i * n + i] += FB_R(1.0);
    }
    non_finite_is_refused(chol_of_F, n, 1);
  }
  FBT_INT_EQ(fb_chol_factor(NULL, 1), FB_ERR_NULL);
  FBT_INT_EQ(fb_chol_factor(F, -1), FB_ERR_VALUE);
  FBT_INT_EQ(fb_chol_factor(F, 0), FB_OK);
}

/* max |X N X^T - diag|_kl with diag NULL: 1, in epsilon of scale. N NULL: 1. */
static double congruence_error(const fb_real *rows, const fb_real *N, const fb_real *diag, double scale, int n)
{
  double worst = 0.0;
  for (int k = 0; k < n; k++) {
    for (int l = 0; l < n; l++) {
      long double sum = k == l ? (diag ? -(long double)diag[k] : -1.0L) : 0.0L;
      for (int i = 0; i < n; i++) {
        long double row = N ? 0.0L : (long double)rows[l * n + i];
        for (int j = 0; N && j < n; j++) {
          row += (long double)N[i * n + j] * (long double)rows[l * n + j];
        }
        sum += (long double)rows[k * n + i] * row;
      }
      worst = fmax(worst, (double)fabsl(sum));
    }
  }
  return worst / (EPS * scale);
}

static int is_ascending(const fb_real *values, int n)
{
  for (int i = 1; i < n; i++) {
    if (!(values[i] >= values[i - 1])) {
      return 0;
    }
  }
  return 1;
}

/* Solves A; V orthogonal to 3 (n + 1) epsilon, V A V^T = d to 2 (n + 1) epsilon of the spectral norm. */
static void jacobi_claims(int n)
{
  copy(F, A, n * n);
  fbt_fill(V, n * n, 1e9);
  FBT_INT_EQ(fb_eig_sym_solve(d, V, F, n), FB_OK);
  FBT_TRUE(is_ascending(d, n));
  FBT_BELOW(congruence_error(V, NULL, NULL, 1.0, n), 3.0 * (n + 1));
  FBT_BELOW(congruence_error(V, A, d, fmax(fbt_largest(d, n), 1e-30), n), 2.0 * (n + 1));
}

static fb_status eig_sym_of_F(int n)
{
  return fb_eig_sym_solve(d, V, F, n);
}

/* E5.3: random, graded and degenerate matrices, the spectrum of the discrete Laplacian with the relative accuracy of
   its smallest eigenvalue (normwise (4 + n/2) epsilon: 24 epsilon of 4 at n = 40 are 4000 epsilon of the smallest),
   and the product of the eigenvalues of D (n 1 + e e^T) D, which is known: it stands only if the smallest of them,
   1e-12 of the largest, have all their digits. */
TEST(jacobi_diagonalizes_random_graded_and_degenerate_matrices)
{
  for (int s = 0; s < FBT_COUNT(size); s++) {
    const int n = size[s];
    double error = 0.0, product = 0.0;
    for (int trial = 0; trial < 5; trial++) {
      symmetric_random(A, n);
      jacobi_claims(n);
      grading_random(D1, n, 20);
      matrix_scale(A, D1, D1, n);
      jacobi_claims(n);
      gram_random(A, n, n / 2, 0); /* n - n/2 eigenvalues zero */
      jacobi_claims(n);
    }
    for (int i = 0; i < n * n; i++) { /* n equal, and n - 1 equal */
      A[i] = i / n == i % n ? FB_R(3.0) : FB_R(0.0);
    }
    jacobi_claims(n);
    FBT_NEAR_ABS(d[0], 3.0, 0.0);
    for (int i = 0; i < n * n; i++) {
      A[i] = FB_R(1.0);
    }
    jacobi_claims(n);
    FBT_NEAR_REL(d[n - 1], n, 4.0 * EPS);
    FBT_NEAR_ABS(n > 1 ? d[n - 2] : 0, 0.0, 2.0 * n * EPS);
    memset(A, 0, sizeof A);
    jacobi_claims(n);
    for (int i = 0; i < n; i++) { /* discrete Laplacian */
      A[i * n + i] = FB_R(2.0);
      if (i > 0) {
        A[i * n + i - 1] = A[(i - 1) * n + i] = -FB_R(1.0);
      }
    }
    jacobi_claims(n);
    for (int k = 0; k < n; k++) {
      const double half = 0.5 * 3.14159265358979323846 * (k + 1) / (n + 1);
      error = fmax(error, fabs((double)d[k] - 4.0 * sin(half) * sin(half)));
    }
    FBT_BELOW(error, (4.0 + 0.5 * n) * EPS);
    grading_random(D1, n, 20);
    for (int i = 0; i < n * n; i++) { /* det(n 1 + e e^T) = 2 n^n */
      A[i] = (i / n == i % n ? (fb_real)n : FB_R(0.0)) + FB_R(1.0);
    }
    matrix_scale(A, D1, D1, n);
    jacobi_claims(n);
    for (int i = 0; i < n; i++) {
      product += log((double)d[i]) - 2.0 * log((double)D1[i]);
    }
    FBT_NEAR_ABS(product, log(2.0) + n * log((double)n), 4.0 * (n + 1) * EPS);
    symmetric_random(A, n);
    non_finite_is_refused(eig_sym_of_F, n, 0);
  }
  FBT_INT_EQ(fb_eig_sym_solve(NULL, V, F, 1), FB_ERR_NULL);
  FBT_INT_EQ(fb_eig_sym_solve(d, NULL, F, 1), FB_ERR_NULL);
  FBT_INT_EQ(fb_eig_sym_solve(d, V, NULL, 1), FB_ERR_NULL);
  FBT_INT_EQ(fb_eig_sym_solve(d, V, F, -1), FB_ERR_VALUE);
  FBT_INT_EQ(fb_eig_sym_solve(d, V, F, 0), FB_OK);
}

/* E5.3: zeros on the diagonal and b off it have the eigenvalues -b and b, however small beside another pair -1, 1, down
   to 1e-9 epsilon; what is below, and an eigenvalue that rests on it, counts as zero; in any unit. What is diagonal and
   in order stays as it is. */
TEST(small_pairs_keep_their_digits_down_to_the_bound)
{
  for (int k = 0; k < 90; k++) {
    const double part = k % 30 == 0 ? 0.99 : k % 30 == 1 ? 1.01 : ldexp(1.01, k % 30); /* 1e-9 epsilon */
    const fb_real unit = (fb_real)ldexp(1.0, 30 * (k / 30 - 1)), off = unit * (fb_real)(part * 1e-9 * EPS);
    const fb_real least = k % 30 ? off : FB_R(0.0);
    for (int at = 1; at < 4; at++) { /* 0 and at are the large pair */
      const int p = at % 3 + 1, q = (at + 1) % 3 + 1;
      memset(A, 0, 16 * sizeof(fb_real));
      A[at] = A[4 * at] = unit;
      A[4 * p + q] = A[4 * q + p] = off;
      FBT_INT_EQ(fb_eig_sym_solve(d, V, A, 4), FB_OK);
      FBT_NEAR_REL(d[0], -unit, 4.0 * EPS);
      FBT_NEAR_REL(d[1], -least, 4.0 * EPS);
      FBT_NEAR_REL(d[2], least, 4.0 * EPS);
      FBT_NEAR_REL(d[3], unit, 4.0 * EPS);
    }
    memset(A, 0, 16 * sizeof(fb_real));
    A[10] = A[15] = unit;
    FBT_INT_EQ(fb_eig_sym_solve(d, V, A, 4), FB_OK);
    for (int i = 0; i < 16; i++) {
      FBT_NEAR_ABS(V[i], i % 5 == 0, 0.0);
    }
  }
}

static fb_status gen_of_K(int n)
{
  copy(K, F, n * n);
  copy(M, A, n * n);
  return fb_eig_gen_solve(d, V, K, M, n);
}

static fb_status gen_of_M(int n)
{
  copy(K, A, n * n);
  copy(M, F, n * n);
  return fb_eig_gen_solve(d, V, K, M, n);
}

/* K in A, M in B: solved in copies. */
static void general_solve(fb_real *values, int n)
{
  copy(K, A, n * n);
  copy(M, B, n * n);
  FBT_INT_EQ(fb_eig_gen_solve(values, V, K, M, n), FB_OK);
  FBT_TRUE(is_ascending(values, n));
}

/* E5.4: X M X^T = 1 and X K X^T = d for random K and M; the linear elements of a rod held at both ends, whose discrete
   eigenvalues are known; units of the coordinates, graded over 1e12, move no eigenvalue. */
TEST(generalized_eigenvectors_diagonalize_both_matrices)
{
  for (int s = 0; s < FBT_COUNT(size); s++) {
    const int n = size[s];
    for (int trial = 0; trial < 5; trial++) {
      symmetric_random(A, n);
      gram_random(B, n, n, 0);
      for (int i = 0; i < n; i++) {
        B[i * n + i] += (fb_real)(0.2 * n); /* condition of M about 10 */
      }
      general_solve(d, n);
      FBT_BELOW(congruence_error(V, B, NULL, 1.0, n), 3.0 * (n + 1));
      FBT_BELOW(congruence_error(V, A, d, fmax(fabs((double)d[0]), fabs((double)d[n - 1])), n), 3.0 * (n + 1));
    }
    memset(A, 0, sizeof A);
    memset(B, 0, sizeof B);
    for (int i = 0; i < n; i++) { /* h = 1 */
      A[i * n + i] = FB_R(2.0);
      B[i * n + i] = FB_R(4.0);
      if (i > 0) {
        A[i * n + i - 1] = A[(i - 1) * n + i] = -FB_R(1.0);
        B[i * n + i - 1] = B[(i - 1) * n + i] = FB_R(1.0);
      }
    }
    for (int graded = 0; graded < 2; graded++) {
      grading_random(D1, n, graded ? 20 : 0);
      matrix_scale(A, D1, D1, n);
      matrix_scale(B, D1, D1, n);
      general_solve(d, n);
      for (int k = 0; k < n; k++) { /* (2 - 2 cos) / (4 + 2 cos), at most 3 */
        const double c = cos(3.14159265358979323846 * (k + 1) / (n + 1));
        FBT_NEAR_ABS(d[k], (1.0 - c) / (2.0 + c), (4.0 + n) * EPS);
      }
      FBT_BELOW(congruence_error(V, B, NULL, 1.0, n), 3.0 * (n + 1));
      FBT_BELOW(congruence_error(V, A, d, 3.0, n), 3.0 * (n + 1));
    }
    for (int trial = 0; trial < 20; trial++) {
      const int r = trial % n;
      symmetric_random(A, n);
      gram_random(F, n, n / 2, 1);
      FBT_INT_EQ(gen_of_M(n), FB_ERR_SINGULAR);
      gram_random(F, n, n + 2, 0);
      F[r * n + r] = -F[r * n + r];
      FBT_INT_EQ(gen_of_M(n), FB_ERR_SINGULAR);
    }
    gram_random(A, n, n + 2, 0);
    for (int i = 0; i < n; i++) {
      A[i * n + i] += FB_R(1.0);
    }
    non_finite_is_refused(gen_of_M, n, 1);
    non_finite_is_refused(gen_of_K, n, 0);
  }
  FBT_INT_EQ(fb_eig_gen_solve(NULL, V, K, M, 1), FB_ERR_NULL);
  FBT_INT_EQ(fb_eig_gen_solve(d, NULL, K, M, 1), FB_ERR_NULL);
  FBT_INT_EQ(fb_eig_gen_solve(d, V, NULL, M, 1), FB_ERR_NULL);
  FBT_INT_EQ(fb_eig_gen_solve(d, V, K, NULL, 1), FB_ERR_NULL);
  FBT_INT_EQ(fb_eig_gen_solve(d, V, K, M, -1), FB_ERR_VALUE);
  FBT_INT_EQ(fb_eig_gen_solve(d, V, K, M, 0), FB_OK);
}

/* Largest |A x - lambda x| over the eigenvectors that are in V2, re and im, in units of epsilon and of n |A|. */
static fb_real V2[2 * MAX_SIZE * MAX_SIZE], general_work[4 * MAX_SIZE * MAX_SIZE], re[MAX_SIZE], im[MAX_SIZE];
static double general_residual(const fb_real *G, int n)
{
  double largest = 0.0, norm = 0.0;
  for (int i = 0; i < n * n; i++) {
    norm = fmax(norm, fabs((double)G[i]));
  }
  for (int k = 0; k < n; k++) {
    const fb_real *v = V2 + 2 * n * k;
    for (int i = 0; i < n; i++) {
      long double u = 0.0L, w = 0.0L;
      for (int j = 0; j < n; j++) {
        u += (long double)G[i * n + j] * (long double)v[j];
        w += (long double)G[i * n + j] * (long double)v[n + j];
      }
      u -= (long double)re[k] * (long double)v[i] - (long double)im[k] * (long double)v[n + i];
      w -= (long double)re[k] * (long double)v[n + i] + (long double)im[k] * (long double)v[i];
      largest = fmax(largest, (double)hypotl(u, w));
    }
  }
  return largest / (EPS * n * norm);
}

/* E5.6: random matrices; rotations, whose eigenvalues are exp(+-i phi), in any basis; the Jordan block, all eigenvalues
   one to the n-th root of rounding; a state matrix whose two halves differ by 2^20 in units; sums are the trace. */
TEST(general_eigenvectors_satisfy_their_equation)
{
  for (int s = 0; s < FBT_COUNT(size); s++) {
    const int n = size[s];
    for (int trial = 0; trial < 6; trial++) {
      double trace = 0.0, sum = 0.0, conjugates = 0.0, scale = 0.0;
      fbt_fill(A, n * n, 1.0);
      if (trial == 4) { /* rotations by 0.1 (k + 1) */
        memset(A, 0, sizeof A);
        for (int k = 0; k < n; k++) {
          const double phi = k + 1 == n && n % 2 ? 0.0 : 0.1 * (k / 2 + 1);
          A[k * n + k] = (fb_real)cos(phi);
          if (phi > 0.0) {
            A[k * n + (k % 2 ? k - 1 : k + 1)] = (fb_real)(k % 2 ? sin(phi) : -sin(phi));
          }
        }
      }
      if (trial == 5) {
        grading_random(D1, n, 20);
        for (int i = 0; i < n * n; i++) {
          A[i] *= D1[i / n] / D1[i % n];
        }
      }
      memcpy(B, A, sizeof A);
      for (int i = 0; i < n; i++) {
        trace += (double)A[i * (n + 1)];
      }
      FBT_INT_EQ(fb_eig_general_solve(re, im, V2, A, general_work, n), FB_OK);
      for (int k = 0; k < n; k++) {
        double length = 0.0;
        sum += (double)re[k];
        conjugates += (double)im[k];
        scale = fmax(scale, hypot((double)re[k], (double)im[k]));
        for (int i = 0; i < 2 * n; i++) {
          length += pow((double)V2[2 * n * k + i], 2.0);
        }
        FBT_NEAR_ABS(length, 1.0, 8.0 * n * EPS);
        if (trial == 4) {
          const double phi = atan2((double)im[k], (double)re[k]) * 10.0;
          FBT_NEAR_ABS(hypot((double)re[k], (double)im[k]), 1.0, 16.0 * EPS);
          FBT_NEAR_ABS(phi, floor(phi + 0.5), 400.0 * EPS);
        }
      }
      FBT_BELOW(general_residual(B, n), 20.0);
      FBT_NEAR_ABS(sum, trace, 8.0 * n * EPS * (1.0 + scale));
      FBT_NEAR_ABS(conjugates, 0.0, 8.0 * n * EPS * (1.0 + scale));
    }
  }
  for (int power = -40; power <= 40; power += 40) { /* Jordan, in any unit */
    const double unit = ldexp(1.0, power);
    memset(A, 0, sizeof A);
    for (int i = 0; i < 5; i++) {
      A[6 * i] = (fb_real)unit;
      A[6 * i + (i < 4)] += i < 4 ? (fb_real)unit : FB_R(0.0);
    }
    memcpy(B, A, sizeof A);
    FBT_INT_EQ(fb_eig_general_solve(re, im, V2, A, general_work, 5), FB_OK);
    for (int k = 0; k < 5; k++) {
      FBT_NEAR_ABS(hypot((double)re[k] / unit - 1.0, (double)im[k] / unit), 0.0, 4.0 * pow(EPS, 0.2));
    }
    FBT_BELOW(general_residual(B, 5), 20.0);
  }
  memset(A, 0, sizeof A);
  FBT_INT_EQ(fb_eig_general_solve(re, im, V2, A, general_work, 3), FB_OK);
  for (int i = 0; i < 18; i++) { /* unit vectors of nothing */
    FBT_NEAR_ABS(V2[i], i % 7 == 0 && i < 15, 0.0);
  }
  A[3] = (fb_real)NAN;
  FBT_INT_EQ(fb_eig_general_solve(re, im, V2, A, general_work, 2), FB_ERR_NOT_FINITE);
  FBT_INT_EQ(fb_eig_general_solve(re, im, V2, A, general_work, -1), FB_ERR_VALUE);
  FBT_INT_EQ(fb_eig_general_solve(re, im, V2, A, general_work, 0), FB_OK);
  FBT_INT_EQ(fb_eig_general_solve(re, im, V2, NULL, general_work, 2), FB_ERR_NULL);
  FBT_INT_EQ(fb_eig_general_solve(re, im, V2, A, NULL, 2), FB_ERR_NULL);
}

/* n x n of one kind, not balanced, not of full rank, of one cycle: 0 random, 1 upper triangle, 2 its transpose, 3
   integers
   -1, 0, 1, 4 rank n/2, 5 the cyclic permutation, 6 a chain of integrators, 7 two blocks, one of them zero. */
static void kind_random(fb_real *X, int n, int kind)
{
  fbt_fill(X, n * n, 1.0);
  if (kind == 4) {
    singular_random(X, n, 4, 0);
  }
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) {
      fb_real *const e = &X[i * n + j];
      *e = (kind == 1 && j < i) || (kind == 2 && j > i) ? FB_R(0.0) : *e;
      *e = kind == 3 ? (fb_real)(int)(1.999 * (double)*e) : *e;
      *e = kind == 5 ? (fb_real)(i == (j + 1) % n) : kind == 6 ? (fb_real)(j == i + 1) : *e;
      *e = kind == 7 && (i < n / 2) != (j < n / 2) ? FB_R(0.0) : *e;
      *e = kind == 7 && i < n / 2 ? FB_R(0.0) : *e;
    }
  }
}

static void general_of_A(int n)
{
  for (int i = 0; i < 2 * n * n; i++) {
    V2[i] = re[i / (2 * n)] = im[i / (2 * n)] = (fb_real)NAN;
  }
  FBT_INT_EQ(fb_eig_general_solve(re, im, V2, A, general_work, n), FB_OK);
}

/* E5.6: whatever the matrix has of zeros, in any unit: its equation, vectors of unit length, the trace; the cyclic
   permutation has the roots of 1. */
TEST(general_eigenvectors_of_matrices_with_zeros)
{
  for (int trial = 0; trial < 3 * 8 * 12; trial++) {
    const int n = 1 + trial % 12, kind = trial / 12 % 8;
    const double unit = ldexp(1.0, 30 * (trial / 96 - 1));
    double sum = 0.0, trace = 0.0;
    kind_random(A, n, kind);
    for (int i = 0; i < n * n; i++) {
      A[i] *= (fb_real)unit;
      trace += i % (n + 1) ? 0.0 : (double)A[i];
    }
    copy(B, A, n * n);
    general_of_A(n);
    FBT_TRUE(general_residual(B, n) < 20.0 || fbt_largest(B, n * n) == 0.0);
    for (int k = 0; k < n; k++) {
      double length = 0.0;
      for (int i = 0; i < 2 * n; i++) {
        length += pow((double)V2[2 * n * k + i], 2.0);
      }
      FBT_NEAR_ABS(length, 1.0, 8.0 * n * EPS);
      sum += (double)re[k] / unit;
      if (kind == 5) {
        const double phi = atan2((double)im[k], (double)re[k]) / (2.0 * 3.14159265358979323846) * n;
        FBT_NEAR_ABS(hypot((double)re[k], (double)im[k]), unit, 8.0 * n * EPS * unit);
        FBT_NEAR_ABS(phi, floor(phi + 0.5), 8.0 * n * EPS);
      }
    }
    FBT_NEAR_ABS(sum, trace / unit, 16.0 * n * EPS);
  }
}

/* E5.6: a state matrix mixes units: D^-1 S D with a symmetric S and powers of two from 1 to 2^-50 (single precision:
   2^-20) in D, in any unit, has the eigenvalues of S, and D times its vectors are those of S, as if D were 1. */
TEST(general_eigenvalues_do_not_depend_on_units)
{
  for (int trial = 0; trial < 3 * 12; trial++) {
    const int n = 1 + trial % 12;
    const double unit = ldexp(1.0, 30 * (trial / 12 - 1));
    symmetric_random(F, n);
    grading_random(D1, n, (int)FBT_TOL(50, 20));
    for (int i = 0; i < n * n; i++) {
      A[i] = F[i] * (fb_real)unit / D1[i / n] * D1[i % n];
    }
    general_of_A(n);
    for (int k = 0; k < n; k++) {
      fb_real *const v = V2 + 2 * n * k;
      double length = 0.0;
      FBT_NEAR_ABS(im[k], 0.0, 0.0);
      re[k] /= (fb_real)unit;
      for (int i = 0; i < 2 * n; i++) {
        v[i] *= D1[i % n];
        length = fmax(length, fabs((double)v[i]));
      }
      for (int i = 0; i < 2 * n; i++) {
        v[i] = (fb_real)((double)v[i] / length);
      }
    }
    FBT_BELOW(general_residual(F, n), 20.0);
  }
}

SUITE(linalg, RUN(general_eigenvectors_of_matrices_with_zeros), RUN(general_eigenvalues_do_not_depend_on_units),
      RUN(general_eigenvectors_satisfy_their_equation), RUN(lu_solves_random_graded_and_refuses_singular_matrices),
      RUN(cholesky_factors_graded_and_refuses_indefinite_matrices),
      RUN(jacobi_diagonalizes_random_graded_and_degenerate_matrices),
      RUN(small_pairs_keep_their_digits_down_to_the_bound), RUN(generalized_eigenvectors_diagonalize_both_matrices))
