/* aero.c - parts of examples/aero that its programs do not use far from their linear range, against closed forms: the
   section table [A1], Jones' lag against Theodorsen's function [A2], loads of a strip beyond stall [A3], the gust [A6],
   inflow by momentum theory [A7], multiblade coordinates [A9]. aero.sh runs it. */
#define _XOPEN_SOURCE 700 /* Bessel's functions */
#include "../../flexbeam.h"
#include <complex.h>
#include <stdio.h>
#include "../../examples/aero/airloads.h"
#include "../../examples/aero/multiblade.h"

static int misses;

static void near(const char *what, double x, double wanted, double tolerance)
{
  const int ok = fabs(x - wanted) <= tolerance;
  misses += !ok;
  printf("%s: %.10g, wanted %.10g, allowed %.2g%s\n", what, x, wanted, tolerance, ok ? " ok" : " FAILED");
}

/* [A1], [A3]: a plate across the wind; thin airfoil below stall; no jump at half a turn. */
static void plate(void)
{
  static air_table t;
  air a = {{&t, 2.0, 0.2, 0}, 1.5, {0}, {{0}, {0}, 0, 0, 0}, 0, {0}, {{{0}}}, {0}, {{0}}, {{0}}, {{0}}, {{0}}};
  double c[3], once[3], F[2], M;
  air_table_plate(&t, 2 * air_pi, 0.2, 0.01);
  air_coefficients(c, &t, 0.1);
  near("lift below stall", c[0], 0.2 * air_pi, 1e-12);
  near("moment below stall", c[2], 0, 1e-12);
  air_coefficients(c, &t, air_pi / 2);
  near("drag of a plate across the wind", c[1], 2.01, 1e-12);
  near("its moment about the quarter chord", c[2], -0.5, 1e-12); /* center of pressure at mid-chord */
  air_coefficients(c, &t, -air_pi / 2);
  near("the same from above", c[2], 0.5, 1e-12);
  air_coefficients(c, &t, air_pi - 1e-9);
  near("lift at half a turn", c[0], 0, 1e-8);
  air_coefficients(c, &t, 0.3 + 6 * air_pi);
  air_coefficients(once, &t, 0.3);
  near("angles go around", c[0], once[0], 1e-12);
  /* it moves down at 3 m/s across the chord: 1/2 rho V^2 c 2.01 upward at mid-chord, 0.2 b before the line */
  air_strip(F, &M, &a, 0, 3, 0);
  near("force on a plate across the wind", F[1], 0.5 * 1.5 * 9 * 2 * 2.01, 1e-9);
  near("its moment about the line", M, 0.5 * 1.5 * 9 * 2 * (2.01 * 0.7 - 0.5 * 2.0), 1e-9);
}

/* [A2]: C(k) = H1/(H1 + i H0) of Hankel's functions of the second kind. */
static void lag(void)
{
  const double complex unit = (double complex)_Complex_I;
  double most = 0;
  for (int i = 0; i < 60; i++) {
    const double k = 0.01 * pow(10.0, i / 20.0);
    const double complex s = unit * k, H0 = j0(k) - unit * y0(k), H1 = j1(k) - unit * y1(k);
    double complex C = 1;
    for (int l = 0; l < 2; l++) {
      C -= air_jones_A[l] * s / (s + air_jones_b[l]);
    }
    most = fmax(most, cabs(C * (H1 + unit * H0) / H1 - 1));
  }
  near("Jones' lag off Theodorsen's function, of its size", most, 0, 0.024);
}

/* [A6], [A7] */
static void gust_and_inflow(void)
{
  const air_gust g = {{0, 0, 5}, {1, 0, 0}, 20, 8, 3};
  const fb_real before[3] = {FB_R(7.5), 0, 0}, middle[3] = {FB_R(3.0), 0, 0}, quarter[3] = {FB_R(5.0), 0, 0};
  double v;
  near("before the gust", air_gust_part(&g, before, 0.2), 0, 0);
  near("in its middle", air_gust_part(&g, middle, 0.2), 1, 1e-6);
  near("in its first quarter", air_gust_part(&g, quarter, 0.2), 0.5, 1e-6);
  near("inflow in hover", air_momentum_inflow(5000, 1.2, 30, 0, 0), sqrt(5000 / 72.0), 1e-9);
  near("in climb", air_momentum_inflow(5000, 1.2, 30, 0, 4), -2 + sqrt(4 + 5000 / 72.0), 1e-9);
  v = air_momentum_inflow(5000, 1.2, 30, 40, 2);
  near("in forward flight: thrust", 2 * 1.2 * 30 * v * sqrt(1600 + (2 + v) * (2 + v)), 5000, 1e-6);
  near("thrust down", air_momentum_inflow(-5000, 1.2, 30, 40, -2), -v, 1e-9);
}

/* [A9]: four blades are given back by their four coordinates. */
static void blades(void)
{
  const double angle[4] = {0.11, -0.05, 0.2, 0.07}, azimuth = 0.6;
  const multiblade m = multiblade_of(angle, 4, azimuth);
  for (int k = 0; k < 4; k++) {
    const double psi = azimuth + k * air_pi / 2;
    near("a blade", m.mean + m.cosine * cos(psi) + m.sine * sin(psi) + (k % 2 ? -m.differential : m.differential),
         angle[k], 1e-15);
  }
}

int main(void)
{
  plate();
  lag();
  gust_and_inflow();
  blades();
  return misses != 0;
}
