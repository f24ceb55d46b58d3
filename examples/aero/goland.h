/* goland.h - Goland's wing: M. Goland, "The flutter of a uniform cantilever wing", J. Appl. Mech. 12, 1945; M. Goland and
   Y. L. Luke, "The flutter of a uniform wing with tip weights", J. Appl. Mech. 15, 1948. Include flexbeam.h, check.h and
   airloads.h before. README.md tells where the numbers come from. */
#ifndef GOLAND_H
#define GOLAND_H
#include <complex.h>

static const double semi_span = 6.096, chord = 1.8288, line = -0.34;     /* [m]; elastic axis at 33 % of the chord */
static const double mass = 35.71, behind = 0.1 * 1.8288;                 /* [kg/m], [m] mass axis at 43 % */
static const double inertia = 8.64;                                      /* [kg m] per length about the elastic axis */
static const double EI = 9.77e6, GJ = 0.987e6;                           /* [N m^2] */
static const double published_speed = 137.2, published_frequency = 70.7; /* [m/s], [rad/s], air of 1.225 kg/m^3 */

/* The wing with the apparent mass of the air, which density 0 leaves out; offset: of the mass axis. `modes` of bending
   and as many of torsion; it is rigid in its plane. Node 1 is the tip. */
static inline void goland_build(fb_body *wing, double density, int modes, double offset)
{
  static fb_build_work work;
  fb_section section = {.mass = (fb_real)mass,
                        .GJ = (fb_real)GJ,
                        .EI_y = (fb_real)EI,
                        .i_z = (fb_real)(inertia - mass * behind * behind),
                        .mass_y = (fb_real)-offset};
  fb_beam_desc beam = {.length = (fb_real)semi_span, .n_element = 12, .n_station = 1};
  const fb_modes_desc keep = {.count = {0, modes, 0, modes}};
  const fb_build_desc desc = {.n_part = 1,
                              .part = {{.n_node = 1, .node = {(fb_real)semi_span}}},
                              .body = {.effects = FB_EFFECTS_LARGE, .base = FB_BASE_PRESCRIBED}};
  air_add_apparent_mass(&section, density, chord, line);
  beam.station[0] = section;
  need(fb_body_build(wing, &work, &desc, &beam, &keep, 1), "wing");
}

/* [A8] The continuous wing: determinant of moment, shear force and torque at the tip by curvature, its slope and twist
   rate at the clamped root, for motion exp(s t), s = i frequency, at this speed. Theodorsen's loads with the deficiency
   C(s) = 1 - sum A_i p/(p + b_i) of Jones, p = s b/U; six linear equations in x, classical Runge-Kutta of 200 steps. */
static inline double complex goland_determinant(double frequency, double density, double speed)
{
  const double b = 0.5 * chord, a = line, U = speed, added = air_pi * density * b * b;
  const double complex s = frequency * (double complex)_Complex_I, p = s * b / U;
  const double complex C = 1 - air_jones_A[0] * p / (p + air_jones_b[0]) - air_jones_A[1] * p / (p + air_jones_b[1]);
  const double complex rear = U + b * (0.5 - a) * s; /* downwash by twist */
  /* lift and moment by deflection (upward) and twist (nose up) */
  const double complex L_z = -added * s * s - 2 * air_pi * density * U * b * C * s;
  const double complex L_t = added * (U * s - b * a * s * s) + 2 * air_pi * density * U * b * C * rear;
  const double complex M_z = -added * b * a * s * s - 2 * air_pi * density * U * b * b * (a + 0.5) * C * s;
  const double complex M_t = -added * (U * b * (0.5 - a) * s + b * b * (0.125 + a * a) * s * s) +
                             2 * air_pi * density * U * b * b * (a + 0.5) * C * rear;
  /* EI z'''' = k_zz z + k_zt theta, GJ theta'' = k_tz z + k_tt theta */
  const double complex k_zz = L_z - mass * s * s, k_zt = L_t + mass * behind * s * s;
  const double complex k_tz = -M_z - mass * behind * s * s, k_tt = inertia * s * s - M_t;
  enum { STEPS = 200 };
  const int tip[3] = {2, 3, 5}; /* of (z, z', z'', z''', theta, theta'): zero at the tip, free at the root */
  double complex D[3][3];
  for (int k = 0; k < 3; k++) {
    double complex y[6] = {0};
    y[tip[k]] = 1;
    for (int i = 0; i < STEPS; i++) {
      const double h = semi_span / STEPS, part[4] = {0, 0.5, 0.5, 1}, weight[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
      double complex rate[6] = {0}, sum[6] = {0};
      for (int stage = 0; stage < 4; stage++) {
        double complex at[6];
        for (int j = 0; j < 6; j++) {
          at[j] = y[j] + h * part[stage] * rate[j];
        }
        memcpy(rate, at + 1, 5 * sizeof at[0]); /* of z, z', z'', theta */
        rate[3] = (k_zz * at[0] + k_zt * at[4]) / EI;
        rate[5] = (k_tz * at[0] + k_tt * at[4]) / GJ;
        for (int j = 0; j < 6; j++) {
          sum[j] += h * weight[stage] * rate[j];
        }
      }
      for (int j = 0; j < 6; j++) {
        y[j] += sum[j];
      }
    }
    for (int j = 0; j < 3; j++) {
      D[j][k] = y[tip[j]];
    }
  }
  return D[0][0] * (D[1][1] * D[2][2] - D[1][2] * D[2][1]) - D[0][1] * (D[1][0] * D[2][2] - D[1][2] * D[2][0]) +
         D[0][2] * (D[1][0] * D[2][1] - D[1][1] * D[2][0]);
}

/* Flutter of the continuous wing: both parts of the determinant vanish; Newton's method from a guess in speed and
   frequency. */
static inline void goland_flutter(double *speed, double *frequency, double density)
{
  for (int k = 0; k < 30; k++) {
    const double h = 1e-5;
    const double complex f = goland_determinant(*frequency, density, *speed);
    const double complex by_w = (goland_determinant(*frequency + h, density, *speed) - f) / h;
    const double complex by_U = (goland_determinant(*frequency, density, *speed + h) - f) / h;
    const double det = creal(by_w) * cimag(by_U) - cimag(by_w) * creal(by_U);
    *frequency -= (creal(f) * cimag(by_U) - cimag(f) * creal(by_U)) / det;
    *speed -= (creal(by_w) * cimag(f) - cimag(by_w) * creal(f)) / det;
  }
}
#endif
