/* exact_curve.h - the reference line of an exact beam through points: a cubic spline (not a knot at the second and the last but
   one, so that an arc is one to its ends) by the length of its chords, then by its own; section axes that do not turn
   about the line begin with y nearest to that of the base. Include flexbeam.h first. */
#ifndef EXACT_CURVE_H
#define EXACT_CURVE_H
#include "../common/text.h"
#include <math.h>

enum { CURVE_POINTS = 200, CURVE_STEPS = 2000, CURVE_STATIONS = FB_MAX_STATIONS };

typedef struct exact_curve {
  int n;
  double x[CURVE_POINTS][3];                     /* [m] points */
  double u[CURVE_POINTS], bend[CURVE_POINTS][3]; /* parameter, second derivatives */
  double s[CURVE_STEPS + 1];                     /* [m] along the line, at equal parameters */
  double along[CURVE_STEPS + 1][3], y[CURVE_STEPS + 1][3],
      kappa[CURVE_STEPS + 1][3]; /* tangent, y axis, curvature, base axes */
} exact_curve;

static inline double curve_dot(const double *a, const double *b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Second derivatives of the spline: continuity at inner points; the third derivative is that of the neighbor in the first
   and the last interval, with three points one parabola, with two a line. 0: it is singular. */
static inline int curve_spline(exact_curve *c)
{
  static fb_real A[CURVE_POINTS * CURVE_POINTS], b[3][CURVE_POINTS], y[CURVE_POINTS];
  static int perm[CURVE_POINTS];
  const int n = c->n;
  memset(A, 0, sizeof A);
  memset(b, 0, sizeof b);
  for (int k = 1; k + 1 < n; k++) {
    const double before = c->u[k] - c->u[k - 1], after = c->u[k + 1] - c->u[k];
    A[k * n + k - 1] = (fb_real)before;
    A[k * n + k] = (fb_real)(2.0 * (before + after));
    A[k * n + k + 1] = (fb_real)after;
    for (int i = 0; i < 3; i++) {
      b[i][k] = (fb_real)(6.0 * ((c->x[k + 1][i] - c->x[k][i]) / after - (c->x[k][i] - c->x[k - 1][i]) / before));
    }
  }
  for (int end = 0; end < 2; end++) { /* row of an end */
    const int k = end ? n - 1 : 0, d = end ? -1 : 1;
    fb_real *const row = A + k * n;
    if (n < 4) {
      row[k] = FB_R(1.0);
      row[k + d] = n == 3 ? -FB_R(1.0) : FB_R(0.0);
    } else {
      const double own = fabs(c->u[k + d] - c->u[k]), next = fabs(c->u[k + 2 * d] - c->u[k + d]);
      row[k] = (fb_real)next;
      row[k + d] = (fb_real)(-own - next);
      row[k + 2 * d] = (fb_real)own;
    }
  }
  if (fb_lu_factor(A, perm, y, n) != FB_OK) {
    return 0;
  }
  for (int i = 0; i < 3; i++) {
    fb_lu_solve(y, A, perm, b[i], n);
    for (int k = 0; k < n; k++) {
      c->bend[k][i] = (double)y[k];
    }
  }
  return 1;
}

/* First and second derivative of the line at parameter u. */
static inline void curve_at(const exact_curve *c, double u, double first[3], double second[3])
{
  int k = 0;
  while (k + 2 < c->n && u > c->u[k + 1]) {
    k++;
  }
  const double h = c->u[k + 1] - c->u[k], b = (u - c->u[k]) / h, a = 1.0 - b;
  for (int i = 0; i < 3; i++) {
    second[i] = a * c->bend[k][i] + b * c->bend[k + 1][i];
    first[i] = (c->x[k + 1][i] - c->x[k][i]) / h +
               h / 6.0 * ((3.0 * b * b - 1.0) * c->bend[k + 1][i] - (3.0 * a * a - 1.0) * c->bend[k][i]);
  }
}

/* Fills the tables from the points; 0, or what is wrong with them. */
static inline const char *curve_fill(exact_curve *c)
{
  double first[3], second[3], before = 0.0;
  if (c->n < 2) {
    return "a line wants two points or more";
  }
  for (int k = 1; k < c->n; k++) {
    const double d[3] = {c->x[k][0] - c->x[k - 1][0], c->x[k][1] - c->x[k - 1][1], c->x[k][2] - c->x[k - 1][2]};
    c->u[k] = c->u[k - 1] + sqrt(curve_dot(d, d));
    if (!(c->u[k] > c->u[k - 1])) {
      return "two points that follow each other are the same";
    }
  }
  if (!curve_spline(c)) {
    return "distances of points differ too much";
  }
  for (int k = 0; k <= CURVE_STEPS; k++) {
    double speed, middle, *const t = c->along[k], *const y = c->y[k];
    curve_at(c, c->u[c->n - 1] * k / CURVE_STEPS, first, second);
    speed = sqrt(curve_dot(first, first));
    if (!(speed > 0.1)) { /* by the parameter, which is nearly the length */
      return "the line turns back: more points where it bends";
    }
    for (int i = 0; i < 3; i++) {
      t[i] = first[i] / speed;
      c->kappa[k][i] = (first[(i + 1) % 3] * second[(i + 2) % 3] - first[(i + 2) % 3] * second[(i + 1) % 3]) /
                       (speed * speed * speed);
    }
    if (k == 0) { /* y of the base across the line, or z where the line leaves along y */
      const double base[3] = {0.0, fabs(t[1]) < 0.99 ? 1.0 : 0.0, fabs(t[1]) < 0.99 ? 0.0 : 1.0};
      const double part = curve_dot(base, t);
      for (int i = 0; i < 3; i++) {
        y[i] = base[i] - part * t[i];
      }
    } else { /* the last y, turned as the tangent turns: across t0 + t both are the same */
      const double *const t0 = c->along[k - 1], *const y0 = c->y[k - 1];
      const double part = curve_dot(y0, t) / (1.0 + curve_dot(t0, t));
      double d[3];
      for (int i = 0; i < 3; i++) {
        y[i] = y0[i] - part * (t0[i] + t[i]);
      }
      curve_at(c, c->u[c->n - 1] * (k - 0.5) / CURVE_STEPS, d, second);
      middle = sqrt(curve_dot(d, d));
      c->s[k] = c->s[k - 1] + c->u[c->n - 1] / CURVE_STEPS / 6.0 * (before + 4.0 * middle + speed); /* Simpson */
    }
    before = speed;
    const double size = sqrt(curve_dot(y, y));
    for (int i = 0; i < 3; i++) {
      y[i] /= size;
    }
  }
  return NULL;
}

/* Curvature at s of the line, section axes. */
static inline void curve_curvature(const exact_curve *c, double s, fb_real kappa[3])
{
  int k = 0;
  while (k + 1 < CURVE_STEPS && s > c->s[k + 1]) {
    k++;
  }
  const double b = (s - c->s[k]) / (c->s[k + 1] - c->s[k]);
  kappa[0] = FB_R(0.0);
  for (int i = 1; i < 3; i++) {
    double at[2];
    for (int e = 0; e < 2; e++) {
      const double *const t = c->along[k + e], *const y = c->y[k + e];
      const double z[3] = {t[1] * y[2] - t[2] * y[1], t[2] * y[0] - t[0] * y[2], t[0] * y[1] - t[1] * y[0]};
      at[e] = curve_dot(c->kappa[k + e], i == 1 ? y : z);
    }
    kappa[i] = (fb_real)(at[0] + b * (at[1] - at[0]));
  }
}

/* The root's section axes to base axes. */
static inline void curve_attitude(const exact_curve *c, fb_real quat[4])
{
  const double *const t = c->along[0], *const y = c->y[0];
  const double z[3] = {t[1] * y[2] - t[2] * y[1], t[2] * y[0] - t[0] * y[2], t[0] * y[1] - t[1] * y[0]};
  const double R[3][3] = {{t[0], y[0], z[0]}, {t[1], y[1], z[1]}, {t[2], y[2], z[2]}};
  const double square[4] = {1 + R[0][0] + R[1][1] + R[2][2], 1 + R[0][0] - R[1][1] - R[2][2],
                            1 - R[0][0] + R[1][1] - R[2][2], 1 - R[0][0] - R[1][1] + R[2][2]};
  int most = 0;
  double q[4];
  for (int k = 1; k < 4; k++) {
    most = square[k] > square[most] ? k : most;
  }
  q[most] = 0.5 * sqrt(square[most]);
  for (int k = 0; k < 4; k++) { /* products of the largest with the others */
    const int a = k < most ? k : most, b = k < most ? most : k;
    if (k != most && a == 0) {
      const int i = b % 3, j = (b + 1) % 3; /* q0 q_b = (R_ji - R_ij)/4 with (b, i, j) cyclic, axes from 1 */
      q[k] = (R[j][i] - R[i][j]) / (4.0 * q[most]);
    } else if (k != most) {
      q[k] = (R[a - 1][b - 1] + R[b - 1][a - 1]) / (4.0 * q[most]);
    }
  }
  for (int k = 0; k < 4; k++) {
    quat[k] = (fb_real)q[k];
  }
}
#endif
