/* >>rotation: unit quaternions, exponential and logarithm. */
#include "fbt.h"

#define EPS FBT_TOL(2.2204460492503131e-16, 1.19209290e-7)
static const double pi = 3.14159265358979323846;

static void quat_random(fb_real q[4])
{
  do {
    fbt_fill(q, 4, 1.0);
  } while (fabs((double)q[0]) + fabs((double)q[1]) + fabs((double)q[2]) + fabs((double)q[3]) < 0.1);
  FBT_INT_EQ(fb_quat_normalize(q), FB_OK);
}

/* A rotation vector of the length angle along a random axis. */
static void rotvec_random(fb_real phi[3], double angle)
{
  double a[3], norm;
  do {
    for (int k = 0; k < 3; k++) {
      a[k] = fbt_random();
    }
    norm = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  } while (norm < 0.1);
  for (int k = 0; k < 3; k++) {
    phi[k] = (fb_real)(angle * a[k] / norm);
  }
}

static double length(const fb_real a[3])
{
  return sqrt((double)a[0] * (double)a[0] + (double)a[1] * (double)a[1] + (double)a[2] * (double)a[2]);
}

/* E4.9: Hamilton's rules: x y = z, y z = x, z x = y, squares -1; and the product is that of the matrices, in that
   order. */
TEST(quaternion_product_is_matrix_product)
{
  for (int i = 1; i < 4; i++) {
    for (int j = 1; j < 4; j++) {
      fb_real p[4] = {0}, q[4] = {0}, r[4] = {9, 9, 9, 9};
      const int k = i == j ? 0 : 6 - i - j;
      const int sign = i == j ? -1 : j == i % 3 + 1 ? 1 : -1;
      p[i] = q[j] = FB_R(1.0);
      fb_quat_mul(r, p, q);
      for (int m = 0; m < 4; m++) {
        FBT_NEAR_ABS(r[m], m == k ? sign : 0, 0.0);
      }
    }
  }
  for (int trial = 0; trial < 200; trial++) {
    static const fb_real one[4] = {1, 0, 0, 0};
    fb_real p[4], q[4], r[4], P[9], Q[9], R[9], PQ[9], s[4];
    quat_random(p);
    quat_random(q);
    fb_quat_mul(r, p, q);
    fb_quat_to_mat33(P, p);
    fb_quat_to_mat33(Q, q);
    fb_quat_to_mat33(R, r);
    fb_mat33_mul(PQ, P, Q);
    FBT_BELOW(fbt_difference(R, PQ, 9), 12.0 * EPS);
    fb_quat_mul(s, one, q);
    FBT_TRUE(memcmp(s, q, sizeof s) == 0);
    fb_quat_mul(s, q, one);
    FBT_TRUE(memcmp(s, q, sizeof s) == 0);
  }
}

/* E4.1: R x is the vector part of q o (0, x) o q*, R is a rotation, the same for every length of q, and +90 degrees
   about z take x to y. */
TEST(quaternion_and_matrix_rotate_alike)
{
  for (int trial = 0; trial < 200; trial++) {
    fb_real q[4], conj[4], minus[4], x[3], pure[4] = {0}, t[4], turned[4], R[9], S[9], y[3], c[3];
    quat_random(q);
    fbt_fill(x, 3, 1.0);
    for (int k = 0; k < 4; k++) {
      conj[k] = k ? -q[k] : q[k];
      minus[k] = -q[k];
    }
    memcpy(pure + 1, x, sizeof x);
    fb_quat_mul(t, q, pure);
    fb_quat_mul(turned, t, conj);
    fb_quat_to_mat33(R, q);
    fb_mat33_mul_vec3(y, R, x);
    FBT_BELOW(fbt_difference(y, turned + 1, 3), 12.0 * EPS);
    FBT_NEAR_ABS(turned[0], 0.0, 8.0 * EPS);
    fb_quat_to_mat33(S, minus);
    FBT_TRUE(memcmp(R, S, sizeof R) == 0);
    for (int k = 0; k < 4; k++) {
      minus[k] *= (fb_real)(0.2 + 0.02 * trial);
    }
    fb_quat_to_mat33(S, minus);
    FBT_BELOW(fbt_difference(R, S, 9), 12.0 * EPS);
    for (int i = 0; i < 3; i++) {
      for (int j = 0; j < 3; j++) {
        FBT_NEAR_ABS(fb_vec3_dot(S + 3 * i, S + 3 * j), i == j, 12.0 * EPS);
      }
    }
    fb_vec3_cross(c, R, R + 3);
    FBT_NEAR_ABS(fb_vec3_dot(c, R + 6), 1.0, 12.0 * EPS);
    fb_mat33_mul_vec3(y, R, q + 1); /* the axis stays */
    FBT_BELOW(fbt_difference(y, q + 1, 3), 8.0 * EPS);
  }
  for (int k = 0; k < 3; k++) {
    fb_real q[4] = {0}, R[9];
    q[0] = q[1 + k] = (fb_real)sqrt(0.5);
    fb_quat_to_mat33(R, q);
    for (int i = 0; i < 3; i++) {
      for (int j = 0; j < 3; j++) {
        const int image = j == k ? i == k : j == (k + 1) % 3 ? i == (k + 2) % 3 : -(i == (k + 1) % 3);
        FBT_NEAR_ABS(R[3 * i + j], image, 2.0 * EPS);
      }
    }
  }
}

/* R = 1 + sin(t)/t p^ + (1 - cos t)/t^2 p^ p^ (Rodrigues), double precision. */
static void rodrigues(double R[9], const fb_real phi[3])
{
  const double t = length(phi), half = sin(0.5 * t);
  const double a = t > 0.0 ? sin(t) / t : 1.0, b = t > 0.0 ? 2.0 * half * half / (t * t) : 0.5;
  const double p[3] = {(double)phi[0], (double)phi[1], (double)phi[2]};
  const double hat[9] = {0.0, -p[2], p[1], p[2], 0.0, -p[0], -p[1], p[0], 0.0};
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      R[3 * i + j] = (i == j) + a * hat[3 * i + j] + b * (p[i] * p[j] - (i == j) * t * t);
    }
  }
}

/* E4.2, E4.3: log(exp(phi)) = phi to a few units in the last place from 1e-30 rad to pi - 1e-6; the matrix is
   Rodrigues'; beyond pi the shorter way round; both signs of q are one rotation. */
TEST(exponential_and_logarithm_are_inverse)
{
  static const double angle[] = {1e-30, 1e-15, 1e-8, 1e-4, 1e-3, 0.03, 0.0632, 0.0633, 0.1,
                                 0.5,   1.0,   1.5,  2.0,  2.5,  3.0,  3.1,    3.1415, 3.14159165};
  for (int i = 0; i < FBT_COUNT(angle); i++) {
    for (int trial = 0; trial < 50; trial++) {
      fb_real phi[3], q[4], minus[4], back[3], R[9];
      double reference[9], norm = 0.0;
      rotvec_random(phi, angle[i]);
      fb_quat_from_rotvec(q, phi);
      fb_quat_to_rotvec(back, q);
      FBT_BELOW(fbt_difference(back, phi, 3) / angle[i], 6.0 * EPS);
      fb_quat_to_mat33(R, q);
      rodrigues(reference, phi);
      for (int k = 0; k < 9; k++) {
        FBT_NEAR_ABS(R[k], reference[k], 8.0 * EPS);
      }
      for (int k = 0; k < 4; k++) {
        minus[k] = -q[k];
        norm += (double)q[k] * (double)q[k];
      }
      FBT_NEAR_ABS(norm, 1.0, 4.0 * EPS);
      fb_quat_to_rotvec(back, minus);
      FBT_BELOW(fbt_difference(back, phi, 3) / angle[i], 6.0 * EPS);
    }
  }
  for (int trial = 0; trial < 200; trial++) { /* pi < |phi| < 2 pi comes back as phi - 2 pi along the axis */
    const double long_way = pi + 3.0 * fabs(fbt_random()) + 1e-3;
    fb_real phi[3], q[4], back[3];
    rotvec_random(phi, long_way);
    fb_quat_from_rotvec(q, phi);
    fb_quat_to_rotvec(back, q);
    for (int k = 0; k < 3; k++) {
      FBT_NEAR_ABS(back[k], (double)phi[k] * (1.0 - 2.0 * pi / length(phi)), 16.0 * EPS);
    }
    quat_random(q);
    q[0] = trial % 4 ? q[0] : FB_R(0.0);
    fb_quat_to_rotvec(back, q);
    FBT_BELOW(length(back), pi * (1.0 + 4.0 * EPS));
  }
  {
    const fb_real zero[3] = {0};
    fb_real q[4] = {9, 9, 9, 9}, back[3] = {9, 9, 9};
    fb_quat_from_rotvec(q, zero);
    FBT_TRUE(q[0] == FB_R(1.0) && q[1] == FB_R(0.0) && q[2] == FB_R(0.0) && q[3] == FB_R(0.0));
    fb_quat_to_rotvec(back, q);
    FBT_TRUE(back[0] == FB_R(0.0) && back[1] == FB_R(0.0) && back[2] == FB_R(0.0));
  }
}

/* E4.2: sin(phi/2)/phi is smooth where the series hands over to the sine, at phi^2/4 = 1e-3: both sides are within two
   units in the last place of the exact value. */
TEST(exponential_is_smooth_where_its_series_ends)
{
  const double edge = 2.0 * sqrt(1e-3);
  for (int i = -200; i <= 200; i++) {
    const double steps = i * (abs(i) > 100 ? 1e-4 : 4.0 * EPS); /* next to the edge, and around it */
    const fb_real phi[3] = {(fb_real)(edge * (1.0 + steps)), FB_R(0.0), FB_R(0.0)};
    const long double half = 0.5L * (long double)phi[0];
    fb_real q[4];
    fb_quat_from_rotvec(q, phi);
    FBT_NEAR_REL(q[1], (double)sinl(half), 2.0 * EPS);
    FBT_NEAR_REL(q[0], (double)cosl(half), 1.0 * EPS);
  }
}

/* E4.11: the length becomes one and the direction stays; nothing to normalize is refused and left alone. */
TEST(normalize_refuses_what_has_no_direction)
{
  for (int trial = 0; trial < 200; trial++) {
    fb_real q[4], unit[4];
    double norm = 0.0, after = 0.0;
    fbt_fill(q, 4, trial % 2 ? 1.0 : 1e-7);
    memcpy(unit, q, sizeof unit);
    FBT_INT_EQ(fb_quat_normalize(unit), FB_OK);
    for (int k = 0; k < 4; k++) {
      norm += (double)q[k] * (double)q[k];
      after += (double)unit[k] * (double)unit[k];
    }
    FBT_NEAR_ABS(after, 1.0, 6.0 * EPS);
    for (int k = 0; k < 4; k++) {
      FBT_NEAR_ABS(unit[k], (double)q[k] / sqrt(norm), 4.0 * EPS);
    }
  }
  for (int k = -1; k < 4; k++) {
    const fb_real bad[4] = {(fb_real)NAN, (fb_real)INFINITY, -(fb_real)INFINITY, FB_HUGE};
    for (int i = 0; i < 4; i++) {
      fb_real q[4] = {0}, before[4];
      if (k >= 0) {
        fbt_fill(q, 4, 1.0);
        q[k] = bad[i];
      }
      memcpy(before, q, sizeof q);
      FBT_INT_EQ(fb_quat_normalize(q), FB_ERR_VALUE);
      FBT_TRUE(memcmp(q, before, sizeof q) == 0);
    }
  }
}

/* E4.6, E4.7: a pose by a twist, and back; a line of constant twist is the product of its parts; a circle's arc. */
TEST(twist_and_pose_are_inverse)
{
  fbt_seed(5);
  for (int k = 0; k < 60; k++) {
    const double size = k < 20 ? 1e-3 : k < 40 ? 0.1 : 3.0;
    fb_real x[6], y[6], r[3], q[4], half[6], h[3], p[4], R[9], end[3], turn[4];
    fbt_fill(x, 6, size / sqrt(3.0));
    fb_pose_from_twist(r, q, x);
    fb_pose_to_twist(y, r, q);
    FBT_BELOW(fbt_difference(x, y, 6), FBT_TOL(1e-14, 3e-6) * (1.0 + size));
    for (int i = 0; i < 6; i++) {
      half[i] = FB_R(0.5) * x[i];
    }
    fb_pose_from_twist(h, p, half);
    fb_quat_to_mat33(R, p);
    fb_mat33_mul_vec3(end, R, h);
    fb_quat_mul(turn, p, p);
    for (int i = 0; i < 3; i++) {
      end[i] += h[i];
    }
    FBT_BELOW(fbt_difference(end, r, 3), FBT_TOL(1e-15, 1e-6) * (1.0 + size));
    FBT_BELOW(fbt_difference(turn, q, 4), FBT_TOL(1e-15, 1e-6));
  }
  {
    const fb_real arc[6] = {FB_R(2.0), 0, 0, 0, 0, FB_R(1.5)};
    fb_real r[3], q[4];
    fb_pose_from_twist(r, q, arc);
    FBT_NEAR_REL(r[0], 2.0 / 1.5 * sin(1.5), FBT_TOL(1e-15, 1e-6));
    FBT_NEAR_REL(r[1], 2.0 / 1.5 * (1.0 - cos(1.5)), FBT_TOL(1e-15, 1e-6));
  }
}

/* E4.6, E4.7: a line of constant curvature is the arc L (sin t, 1 - cos t)/t, and the arc that line, on both sides of
   where the series of c and g hand over, at t = 0.1: within some units in the last place. What stands beside the twist
   is no number. */
TEST(arcs_are_exact_where_the_series_end)
{
  for (int k = 1; k <= 60; k++) {
    const fb_real t = (fb_real)(k <= 40 ? 0.005 * k : 0.15 * (k - 40)), nan = (fb_real)NAN;
    const double half = 0.5 * (double)t, x = sin((double)t) / (double)t, y = sin(half) * sin(half) / half;
    const fb_real arc[6] = {FB_R(1.0), FB_R(0.0), FB_R(0.0), FB_R(0.0), FB_R(0.0), t};
    const fb_real end[3] = {(fb_real)x, (fb_real)y, FB_R(0.0)};
    const fb_real turn[4] = {(fb_real)cos(half), FB_R(0.0), FB_R(0.0), (fb_real)sin(half)};
    fb_real r[3] = {nan, nan, nan}, q[4] = {nan, nan, nan, nan}, twist[18];
    for (int i = 0; i < 18; i++) {
      twist[i] = nan;
    }
    fb_pose_from_twist(r, q, arc);
    fb_pose_to_twist(twist + 6, end, turn);
    FBT_BELOW(fbt_difference(r, end, 3), 4.0 * EPS);
    FBT_BELOW(fbt_difference(q, turn, 4), 2.0 * EPS);
    FBT_BELOW(fbt_difference(twist + 6, arc, 6), 8.0 * EPS);
    FBT_TRUE(twist[5] != twist[5] && twist[12] != twist[12]);
  }
}

/* E4.8: 4 tan(phi/4) along the axis, and beyond half a turn that of the rotation the other way round. */
TEST(wiener_milenkovic_parameters_rescale)
{
  for (int k = -30; k <= 30; k++) {
    const double phi = 0.21 * k, turn = 2.0 * acos(-1.0), within = phi - turn * floor(phi / turn + 0.5);
    const fb_real axis[3] = {FB_R(0.6), FB_R(0.0), FB_R(-0.8)};
    fb_real v[3], q[4], c[3], back[4], R[9], S[9];
    for (int i = 0; i < 3; i++) {
      v[i] = (fb_real)phi * axis[i];
    }
    fb_quat_from_rotvec(q, v);
    fb_quat_to_wiener_milenkovic(c, q);
    FBT_NEAR_ABS(c[0], 0.6 * 4.0 * tan(within / 4.0), FBT_TOL(1e-14, 1e-5));
    FBT_NEAR_ABS(c[2], -0.8 * 4.0 * tan(within / 4.0), FBT_TOL(1e-14, 1e-5));
    fb_quat_from_wiener_milenkovic(back, c);
    fb_quat_to_mat33(R, q);
    fb_quat_to_mat33(S, back);
    FBT_BELOW(fbt_difference(R, S, 9), FBT_TOL(1e-14, 1e-5));
  }
}

SUITE(rotation, RUN(twist_and_pose_are_inverse), RUN(arcs_are_exact_where_the_series_end),
      RUN(wiener_milenkovic_parameters_rescale), RUN(quaternion_product_is_matrix_product),
      RUN(quaternion_and_matrix_rotate_alike), RUN(exponential_and_logarithm_are_inverse),
      RUN(exponential_is_smooth_where_its_series_ends), RUN(normalize_refuses_what_has_no_direction))
