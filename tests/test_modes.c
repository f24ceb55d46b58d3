/* Section 7: natural modes, against closed forms and published tables, and against element matrices integrated here in
   double from the polynomials of the shapes. Needs the default capacities or larger ones. */
#include "fbt.h"

#define EPS FBT_TOL(2.2204460492503131e-16, 1.19209290e-7)
#define MAX_DOF (14 * FB_MAX_ELEMENTS + 6)
/* Elements where rounding and truncation balance: in single precision the stiffness of short elements cancels, and the
   first bending frequency of n elements is uncertain by a few 1e-8 n^4. */
#define ELEMENTS FBT_TOL(10, 4)
#define ROUNDING FBT_TOL(1e-11, 1e-4)
static const double pi = 3.14159265358979323846;

static fb_beam_desc desc;
static fb_beam beam;
static fb_modes modes, other, pattern;
static fb_modes_work work;

/* Length 2, mass 3, EI_y 5, EI_z 7, EA 11, GJ 13, polar inertia 0: bending factors sqrt(EI / (m L^4)). */
static void uniform_desc(int n_element, fb_root root)
{
  memset(&desc, 0, sizeof desc);
  desc.length = FB_R(2.0);
  desc.n_element = n_element;
  desc.root = root;
  desc.n_station = 1;
  desc.station[0].mass = FB_R(3.0);
  desc.station[0].EI_y = FB_R(5.0);
  desc.station[0].EI_z = FB_R(7.0);
  desc.station[0].EA = FB_R(11.0);
  desc.station[0].GJ = FB_R(13.0);
}

static fb_status solve(fb_modes *out, int bend_y, int bend_z, int axial, int torsion)
{
  static fb_modes_desc keep;
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Y] = bend_y;
  keep.count[FB_KIND_BEND_Z] = bend_z;
  keep.count[FB_KIND_AXIAL] = axial;
  keep.count[FB_KIND_TORSION] = torsion;
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  return fb_modes_solve(out, &work, &beam, &keep);
}

/* Frequency of the k-th mode (from 1) of a kind. */
static double omega_of(const fb_modes *in, fb_kind kind, int k)
{
  for (int i = 0; i < in->n; i++) {
    k -= in->kind[i] == kind;
    if (k == 0) {
      return (double)in->omega[i];
    }
  }
  FBT_INT_EQ(k, 0); /* the mode exists */
  return 0.0;
}

/* What an element of polynomial degree p must do wrong: relative error of the frequency of wave number b and length h,
   (q!/(2q)!)^2 / (2 (2q+1)) (b h)^(2q) with q = p - 1 in bending and q = p axially: 1/1440 and 1/24 for the classical
   elements, and with the internal shapes q = 4 and 3. */
static double element_error(int q, double bh)
{
  double c = 1.0;
  for (int i = q + 1; i <= 2 * q; i++) {
    c /= i;
  }
  return c * c / (2.0 * (2 * q + 1)) * pow(bh, 2 * q);
}

/* From above by Rayleigh and Ritz, by no more than elements of that degree must. */
static void frequency_is_near(double got, double exact, int q, double bh)
{
  FBT_BELOW(got / exact - 1.0, 1.5 * element_error(q, bh) + ROUNDING);
  FBT_BELOW(-ROUNDING, got / exact - 1.0);
}

/* E7.1, E7.2, E6.5: uniform beams, p01_uniform_beams.csv: clamped, pinned and free roots, both planes, extension and
   twist, six modes each. In double precision ten elements give the first three cantilever frequencies to 1e-8. */
TEST(beam_frequencies_match_the_closed_form)
{
  static const char *const boundary[3] = {"clamped-free", "pinned-free", "free-free"};
  const fbt_table *table = fbt_reference("p01_uniform_beams.csv");
  int rows = 0;
  double first_three = 0.0;
  for (int root = 0; root < 3; root++) {
    const double h = 1.0 / ELEMENTS;
    uniform_desc((int)ELEMENTS, (fb_root)root);
    FBT_INT_EQ(solve(&modes, 6, 6, 0, 0), FB_OK);
    desc.station[0].i_y = FB_R(0.25); /* for twist alone; slopes feel it, so bending is not asked for */
    desc.station[0].i_z = FB_R(0.75);
    FBT_INT_EQ(solve(&other, 0, 0, 6, 6), FB_OK);
    for (int row = 0; row < table->rows; row++) {
      const int mode = (int)fbt_value(table, row, "mode");
      const double b = fbt_value(table, row, "beta_or_kL"), freq = fbt_value(table, row, "freq");
      if (strcmp(fbt_word(table, row, "boundary"), boundary[root]) != 0) {
        continue;
      }
      rows++;
      if (strcmp(fbt_word(table, row, "kind"), "bending") == 0) {
        frequency_is_near(omega_of(&modes, FB_KIND_BEND_Y, mode), freq * sqrt(7.0 / 48.0), 4, b * h);
        frequency_is_near(omega_of(&modes, FB_KIND_BEND_Z, mode), freq * sqrt(5.0 / 48.0), 4, b * h);
        if (root == 0 && mode <= 3) {
          first_three =
              fmax(first_three, fabs(omega_of(&modes, FB_KIND_BEND_Y, mode) / (freq * sqrt(7.0 / 48.0)) - 1.0));
          FBT_NEAR_REL(omega_of(&modes, FB_KIND_BEND_Y, mode), freq * sqrt(7.0 / 48.0), FBT_TOL(1e-8, 5e-5));
        }
      } else if (root != 1) { /* a pinned root holds both, as a clamped one */
        frequency_is_near(omega_of(&other, FB_KIND_AXIAL, mode), freq * sqrt(11.0 / 12.0), 3, b * h);
        frequency_is_near(omega_of(&other, FB_KIND_TORSION, mode), freq * sqrt(13.0 / 4.0), 3, b * h);
      }
    }
  }
  FBT_INT_EQ(rows, 30);
  fbt_figure("cantilever, first three frequencies", "closed form (p01)", first_three);
}

/* E6.5: halving the elements divides the error of a frequency by 2^8 in bending and 2^6 axially, third modes of a
   pinned beam; coarse meshes in single precision, where finer ones drown in rounding. */
TEST(frequencies_converge_with_order_eight_and_six)
{
  double error[2], rod[2];
  for (int i = 0; i < 2; i++) {
    uniform_desc((int)FBT_TOL(6, 2) << i, FB_ROOT_PINNED);
    FBT_INT_EQ(solve(&modes, 3, 0, 0, 0), FB_OK);
    error[i] = omega_of(&modes, FB_KIND_BEND_Y, 3) / (104.2476964588613 * sqrt(7.0 / 48.0)) - 1.0;
    uniform_desc(4 << i, FB_ROOT_PINNED);
    FBT_INT_EQ(solve(&modes, 0, 0, 3, 0), FB_OK);
    rod[i] = omega_of(&modes, FB_KIND_AXIAL, 3) / (2.5 * pi * sqrt(11.0 / 12.0)) - 1.0;
  }
  FBT_NEAR_ABS(log2(error[0] / error[1]), 8.0, 0.25);
  FBT_NEAR_ABS(log2(rod[0] / rod[1]), 6.0, 0.25);
}

/* E6.1, E6.3: the finite-element coordinates alone are the classical elements: errors 1/1440 (b h)^4 of cubic
   bending, from which order 4 follows (gain 16), and 1/24 (k h)^2 of linear extension, order 2 (gain 4). */
TEST(element_coordinates_converge_with_order_four_and_two)
{
  double error[2], rod[2];
  for (int i = 0; i < 2; i++) {
    static fb_real d[FB_MAX_MODES], X[FB_MAX_MODES * FB_MAX_MODES];
    static fb_modes_desc keep;
    const int n = 3 << i, mode = (int)FBT_TOL(1, 2); /* single precision: one with a larger error */
    static const double b[2] = {1.875104068711961, 4.694091132974175};
    for (int axial = 0; axial < 2; axial++) {
      uniform_desc(n, FB_ROOT_CLAMPED);
      memset(&keep, 0, sizeof keep);
      keep.basis = FB_BASIS_ELEMENTS;
      keep.count[axial ? FB_KIND_AXIAL : FB_KIND_BEND_Y] = 1;
      FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
      FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, &keep), FB_OK);
      FBT_INT_EQ(modes.n, axial ? n : 2 * n);
      FBT_INT_EQ(fb_eig_gen_solve(d, X, modes.K, modes.M, modes.n), FB_OK);
      if (axial) {
        rod[i] = sqrt((double)d[0]) / (0.5 * pi * sqrt(11.0 / 12.0)) - 1.0;
        FBT_NEAR_REL(rod[i], element_error(1, 0.5 * pi / n), 0.05);
      } else {
        error[i] = sqrt((double)d[mode - 1]) / (b[mode - 1] * b[mode - 1] * sqrt(7.0 / 48.0)) - 1.0;
        FBT_NEAR_REL(error[i], element_error(2, b[mode - 1] / n), FBT_TOL(0.05, 0.3));
      }
    }
  }
  FBT_NEAR_REL(error[0] / error[1], 16.0, FBT_TOL(0.05, 0.3));
  FBT_NEAR_REL(rod[0] / rod[1], 4.0, 0.05);
}

/* Cantilever with section rotary inertia i (Rayleigh) and a tip body of mass m_t, its center e beyond the tip,
   inertia j about it: w = A (cosh ax - cos bx) + B (sinh(ax)/a - sin(bx)/b), a^2, b^2 = -+p + sqrt(p^2 + q), p = i
   omega^2 / 2 EI, q = m omega^2 / EI; tip: EI w'' = omega^2 (j w' + m_t e (w + e w')), -EI w''' = omega^2 (i w' +
   m_t (w + e w')). */
static double tip_determinant(double omega, double L, double m, double EI, double i, double mt, double e, double j)
{
  const double o2 = omega * omega, p = 0.5 * i * o2 / EI, q = m * o2 / EI;
  const double a = sqrt(sqrt(p * p + q) - p), b = sqrt(sqrt(p * p + q) + p);
  const double ch = cosh(a * L), sh = sinh(a * L), c = cos(b * L), s = sin(b * L);
  double moment[2], force[2];
  for (int k = 0; k < 2; k++) {
    const double w = k ? sh / a - s / b : ch - c, w1 = k ? ch - c : a * sh + b * s;
    const double w2 = k ? a * sh + b * s : a * a * ch + b * b * c;
    const double w3 = k ? a * a * ch + b * b * c : a * a * a * sh - b * b * b * s;
    moment[k] = EI * w2 - o2 * (j * w1 + mt * e * (w + e * w1));
    force[k] = EI * w3 + o2 * (i * w1 + mt * (w + e * w1));
  }
  return (moment[0] * force[1] - moment[1] * force[0]) / (ch * ch);
}

/* Its k-th frequency (from 1): scan and bisection, the step a hundredth of the first without tip body. */
static double tip_omega(int k, double L, double m, double EI, double i, double mt, double e, double j)
{
  const double step = 0.035 * sqrt(EI / (m * L * L * L * L));
  double low = 0.1 * step, f = tip_determinant(low, L, m, EI, i, mt, e, j);
  for (int n = 0; n < 20000; n++) {
    const double high = low + step, g = tip_determinant(high, L, m, EI, i, mt, e, j);
    if ((f < 0.0) != (g < 0.0) && --k == 0) {
      double x = low, y = high;
      for (int bisect = 0; bisect < 60; bisect++) {
        const double mid = 0.5 * (x + y), h = tip_determinant(mid, L, m, EI, i, mt, e, j);
        if ((h < 0.0) == (f < 0.0)) {
          x = mid;
        } else {
          y = mid;
        }
      }
      return 0.5 * (x + y);
    }
    low = high;
    f = g;
  }
  return 0.0;
}

/* The k-th root (from 1) of x tan x = ratio. */
static double tan_root(int k, double ratio)
{
  double low = (k - 1) * pi, high = low + 0.5 * pi;
  for (int bisect = 0; bisect < 60; bisect++) {
    const double mid = 0.5 * (low + high);
    if (mid * sin(mid) * cos(mid) < ratio * cos(mid) * cos(mid)) {
      low = mid;
    } else {
      high = mid;
    }
  }
  return low;
}

/* E6.4: point masses on the tip, p01_tip_mass.csv; bodies with inertia and their center beyond the tip against the
   frequency equation above, which first has to give the table; twist and extension: k L tan(k L) = beam / tip
   inertia. */
TEST(tip_mass_lowers_the_frequencies_as_published)
{
  const fbt_table *table = fbt_reference("p01_tip_mass.csv");
  const double h = 1.0 / ELEMENTS, y = sqrt(7.0 / 48.0), z = sqrt(5.0 / 48.0);
  FBT_INT_EQ(table->rows, 12);
  for (int row = 0; row < table->rows; row++) {
    const double mu = fbt_value(table, row, "mu"), freq = fbt_value(table, row, "freq");
    const double b = fbt_value(table, row, "betaL");
    const int mode = (int)fbt_value(table, row, "mode");
    uniform_desc((int)ELEMENTS, FB_ROOT_CLAMPED);
    desc.n_lump = 1;
    desc.lump[0].node = desc.n_element;
    desc.lump[0].mass = (fb_real)(6.0 * mu);
    FBT_INT_EQ(solve(&modes, 6, 6, 0, 0), FB_OK);
    frequency_is_near(omega_of(&modes, FB_KIND_BEND_Y, mode), freq * y, 4, b * h);
    frequency_is_near(omega_of(&modes, FB_KIND_BEND_Z, mode), freq * z, 4, b * h);
    FBT_NEAR_REL(tip_omega(mode, 1.0, 1.0, 1.0, 0.0, mu, 0.0, 0.0), freq, 1e-9);
  }
  desc.lump[0].mass = FB_R(4.0);
  desc.lump[0].center[0] = FB_R(0.25);
  desc.lump[0].inertia[0] = FB_R(0.5);
  desc.lump[0].inertia[1] = FB_R(1.5);
  desc.lump[0].inertia[2] = FB_R(1.25);
  desc.station[0].i_y = FB_R(0.125);
  desc.station[0].i_z = FB_R(0.375);
  FBT_INT_EQ(solve(&modes, 4, 4, 0, 0), FB_OK);
  FBT_INT_EQ(solve(&other, 0, 0, 3, 3), FB_OK);
  for (int mode = 1; mode <= 4; mode++) {
    const double omega_y = tip_omega(mode, 2.0, 3.0, 7.0, 0.375, 4.0, 0.25, 1.25);
    const double omega_z = tip_omega(mode, 2.0, 3.0, 5.0, 0.125, 4.0, 0.25, 1.5);
    frequency_is_near(omega_of(&modes, FB_KIND_BEND_Y, mode), omega_y, 4, pi * mode * h);
    frequency_is_near(omega_of(&modes, FB_KIND_BEND_Z, mode), omega_z, 4, pi * mode * h);
  }
  for (int mode = 1; mode <= 3; mode++) {
    const double axial = tan_root(mode, 6.0 / 4.0), twist = tan_root(mode, 1.0 / 0.5);
    frequency_is_near(omega_of(&other, FB_KIND_AXIAL, mode), 0.5 * axial * sqrt(11.0 / 3.0), 3, axial * h);
    frequency_is_near(omega_of(&other, FB_KIND_TORSION, mode), 0.5 * twist * sqrt(13.0 / 0.5), 3, twist * h);
  }
}

/* E6.3: rotary inertia of the sections, in each plane its own: the Rayleigh cantilever, whose frequency equation
   (above, without a tip body) is closed; without rotary inertia it gives Euler's. */
TEST(rotary_inertia_lowers_the_frequencies_as_rayleigh_found)
{
  uniform_desc((int)ELEMENTS, FB_ROOT_CLAMPED);
  desc.station[0].i_y = FB_R(0.0625);
  desc.station[0].i_z = FB_R(0.1875);
  FBT_NEAR_REL(tip_omega(1, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0), 3.516015268500151, 1e-12);
  FBT_INT_EQ(solve(&modes, 4, 4, 0, 0), FB_OK);
  for (int mode = 1; mode <= 4; mode++) {
    const double omega_y = tip_omega(mode, 2.0, 3.0, 7.0, 0.1875, 0.0, 0.0, 0.0);
    const double omega_z = tip_omega(mode, 2.0, 3.0, 5.0, 0.0625, 0.0, 0.0, 0.0);
    FBT_BELOW(omega_y / tip_omega(mode, 2.0, 3.0, 7.0, 0.0, 0.0, 0.0, 0.0), 0.99); /* it matters here */
    frequency_is_near(omega_of(&modes, FB_KIND_BEND_Y, mode), omega_y, 4, pi * mode / ELEMENTS);
    frequency_is_near(omega_of(&modes, FB_KIND_BEND_Z, mode), omega_z, 4, pi * mode / ELEMENTS);
  }
}

/* E6.3: cantilever of linear taper at rest, p02_rotating_tapered.csv (alpha = eta = 0): mass 1 - x/2 is a table of
   two stations, EI = (1 - x/2)^3 one of all stations, lowered by h^2/12 EI'' so that the chords hold the same area
   (without that they are too stiff on average, 3e-5 in frequency). */
TEST(tapered_beam_has_the_published_frequencies)
{
  const fbt_table *table = fbt_reference("p02_rotating_tapered.csv");
  const double chord = 1.0 / (FB_MAX_STATIONS - 1);
  int rows = 0;
  uniform_desc((int)ELEMENTS, FB_ROOT_CLAMPED);
  desc.length = FB_R(1.0);
  desc.station[0].EA = desc.station[0].GJ = FB_R(0.0);
  desc.n_station = FB_MAX_STATIONS;
  for (int k = 0; k < FB_MAX_STATIONS; k++) {
    const double x = (double)k / (FB_MAX_STATIONS - 1), height = 1.0 - 0.5 * x;
    desc.station[k].x = (fb_real)x;
    desc.station[k].mass = (fb_real)height;
    desc.station[k].EI_y = desc.station[k].EI_z = (fb_real)(height * (height * height - chord * chord / 8.0));
  }
  FBT_INT_EQ(solve(&modes, 4, 4, 0, 0), FB_OK);
  for (int row = 0; row < table->rows; row++) {
    if (fbt_value(table, row, "alpha") <= 0.0 && fbt_value(table, row, "eta") <= 0.0) {
      const int mode = (int)fbt_value(table, row, "mode");
      const double mu = fbt_value(table, row, "mu_flap");
      FBT_NEAR_REL(omega_of(&modes, FB_KIND_BEND_Y, mode), mu, FBT_TOL(3e-7, 5e-4));
      FBT_NEAR_REL(omega_of(&modes, FB_KIND_BEND_Z, mode), mu, FBT_TOL(3e-7, 5e-4));
      rows++;
    }
  }
  FBT_INT_EQ(rows, 4);
  for (int join = 0; join < 2; join++) { /* E6.14: the same from dimensions, in one stretch or in two */
    const fb_material material = {FB_R(12.0), FB_R(5.0), FB_R(1.0)};
    fb_profile root = {FB_PROFILE_RECTANGLE, FB_R(0.0), {FB_R(1.0), FB_R(1.0)}}, tip = root, middle = root;
    tip.x = FB_R(1.0);
    tip.size[1] = FB_R(0.5);
    middle.x = FB_R(0.5);
    middle.size[1] = FB_R(0.75);
    desc.n_station = 0;
    FBT_INT_EQ(fb_beam_desc_add_taper(&desc, &material, &root, join ? &middle : &tip, 31), FB_OK);
    if (join) {
      FBT_INT_EQ(fb_beam_desc_add_taper(&desc, &material, &middle, &tip, 31), FB_OK);
    }
    FBT_INT_EQ(desc.n_station, join ? 61 : 31);
    for (int k = 0; k < desc.n_station; k++) { /* Euler-Bernoulli, as in the reference */
      desc.station[k].GA_y = desc.station[k].GA_z = desc.station[k].i_y = desc.station[k].i_z = FB_R(0.0);
    }
    FBT_INT_EQ(solve(&modes, 0, 4, 0, 0), FB_OK);
    for (int row = 0; row < table->rows; row++) {
      if (fbt_value(table, row, "alpha") <= 0.0 && fbt_value(table, row, "eta") <= 0.0) {
        FBT_NEAR_REL(omega_of(&modes, FB_KIND_BEND_Z, (int)fbt_value(table, row, "mode")),
                     fbt_value(table, row, "mu_flap"), FBT_TOL(join ? 1e-6 : 5e-6, 5e-4));
      }
    }
  }
}

/* Section of the Timoshenko beams: rectangle 1 x h, E = 1, density 1, in a plane; the other plane is another beam. */
static void timoshenko_desc(int n_element, fb_root root, int plane, double h, double GA)
{
  fb_section *s = desc.station;
  uniform_desc(n_element, root);
  s->EA = s->GJ = FB_R(0.0);
  s->mass = (fb_real)h;
  s->EI_y = s->EI_z = s->i_y = s->i_z = (fb_real)(h * h * h / 12.0);
  *(plane ? &s->EI_z : &s->EI_y) *= FB_R(7.0);
  s->GA_y = s->GA_z = (fb_real)GA;
  *(plane ? &s->GA_y : &s->GA_z) *= FB_R(5.0);
}

/* E6.9, E6.3: Timoshenko beams with rotary inertia, p01_timoshenko.csv: slender and stocky, clamped and free, six modes
   each, in both planes; on a coarse mesh the error falls with the eighth power of the element length. */
TEST(timoshenko_beams_have_the_published_frequencies)
{
  const fbt_table *table = fbt_reference("p01_timoshenko.csv");
  double largest = 0.0, coarse[2] = {0.0, 0.0};
  for (int row = 0; row < table->rows; row++) {
    const double ratio = fbt_value(table, row, "L_over_h"), h = 2.0 / ratio;
    const double GA = fbt_value(table, row, "kappa") * h / (2.0 * (1.0 + fbt_value(table, row, "nu")));
    const double omega = fbt_value(table, row, "freq") * h / sqrt(12.0) / 4.0;
    const int mode = (int)fbt_value(table, row, "mode");
    const fb_root root = strcmp(fbt_word(table, row, "bc"), "cf") == 0 ? FB_ROOT_CLAMPED : FB_ROOT_FREE;
    for (int plane = 0; plane < 2; plane++) {
      const fb_kind kind = plane ? FB_KIND_BEND_Z : FB_KIND_BEND_Y;
      timoshenko_desc((int)ELEMENTS, root, plane, h, GA);
      FBT_INT_EQ(solve(&modes, plane ? 0 : 6, plane ? 6 : 0, 0, 0), FB_OK);
      largest = fmax(largest, fabs(omega_of(&modes, kind, mode) / omega - 1.0));
      for (int mesh = 0; mesh < 2 && mode == 4 && ratio < 10.0; mesh++) {
        timoshenko_desc(4 << mesh, root, plane, h, GA);
        FBT_INT_EQ(solve(&modes, plane ? 0 : 6, plane ? 6 : 0, 0, 0), FB_OK);
        coarse[mesh] += omega_of(&modes, kind, mode) / omega - 1.0;
      }
    }
  }
  FBT_INT_EQ(table->rows, 24);
  FBT_BELOW(largest, FBT_TOL(1e-5, 1e-2)); /* ten elements, four in single */
  fbt_figure("Timoshenko beams, six frequencies", "transfer matrix (p01)", largest);
  FBT_NEAR_ABS(log2(coarse[0] / coarse[1]), 8.0, FBT_TOL(0.5, 2.5));
}

/* A desc for fb_modes_solve, and the beam of desc. */
static fb_modes_desc *choice(void)
{
  static fb_modes_desc keep;
  memset(&keep, 0, sizeof keep);
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  return &keep;
}

/* E7.9: Hopkins' example of Hurty's method (C.3, p09_hurty.csv, ERRATA.md): one cubic element l, M, EI, the boundary q1 =
   u_x and q3 = u_y, q5 = theta_z at one end, q2 = u_x at the other, one fixed-interface mode eta kept, scaled to phi4^2
   + (l phi6)^2 = 1. */
TEST(hurty_example_has_the_printed_numbers)
{
  static const char *const name[5] = {"q1", "q2", "q3", "lq5", "eta"};
  static const fb_coordinate boundary[4] = {{0, 0}, {1, 0}, {0, 1}, {0, 5}};
  const fbt_table *table = fbt_reference("p09_hurty.csv");
  const double l = 2.0, mass = 6.0, EI = 7.0;
  fb_modes_desc *keep;
  double scale = 0.0;
  int checked = 0;
  uniform_desc(1, FB_ROOT_FREE);
  desc.station[0].EI_y = desc.station[0].GJ = FB_R(0.0);
  keep = choice();
  keep->basis = FB_BASIS_COMPONENT;
  keep->cubic = 1;
  keep->count[FB_KIND_BEND_Y] = 2;
  keep->n_boundary = 4;
  memcpy(keep->boundary, boundary, sizeof boundary);
  FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
  FBT_INT_EQ(modes.n, 6);
  for (int row = 0; row < table->rows; row++) {
    const char *what = fbt_word(table, row, "quantity"), *i = fbt_word(table, row, "i"), *j = fbt_word(table, row, "j");
    const double value = fbt_value(table, row, "value");
    const int k = i[0] == '2' ? 5 : 4;
    const fb_real *shape = modes.shape + k * modes.ndof;
    const double norm = sqrt(pow((double)shape[7], 2.0) + pow(l * (double)shape[11], 2.0));
    scale = k == 4 ? 1.0 / norm : scale;
    if (strcmp(what, "omega") == 0) {
      FBT_NEAR_REL((double)modes.omega[k] / sqrt(EI / (mass * l * l * l)), value, FBT_TOL(1e-13, 1e-5));
    } else if (strcmp(what, "phi_q4") == 0) {
      FBT_NEAR_REL((double)shape[7] / norm, value, FBT_TOL(1e-13, 1e-5));
    } else if (strcmp(what, "phi_l_q6") == 0) {
      FBT_NEAR_REL(l * (double)shape[11] / norm, value, FBT_TOL(1e-13, 1e-5));
    } else if (what[1] == 'r') { /* Mred, Kred_bending */
      int a = 0, b = 0;
      double unit = what[0] == 'M' ? mass : EI / (l * l * l);
      while (a < 4 && strcmp(i, name[a]) != 0) {
        a++;
      }
      while (b < 4 && strcmp(j, name[b]) != 0) {
        b++;
      }
      unit *= (a == 4 ? 1.0 / scale : 1.0) * (b == 4 ? 1.0 / scale : 1.0) * (a == 3 ? l : 1.0) * (b == 3 ? l : 1.0);
      if (what[0] == 'K' && a < 2) {
        continue; /* the axial part is EA/l (1, -1) */
      }
      FBT_NEAR_ABS((what[0] == 'M' ? modes.M : modes.K)[a * modes.n + b], value * unit, FBT_TOL(1e-13, 1e-4) * unit);
      checked++;
    } else {
      FBT_TRUE(strcmp(what, "lambda_prime") == 0); /* 1/omega^2 */
    }
  }
  FBT_INT_EQ(checked, 23);
  FBT_NEAR_REL(modes.K[0], 11.0 / 2.0, FBT_TOL(1e-13, 1e-5));
  FBT_NEAR_REL(modes.K[1], -11.0 / 2.0, FBT_TOL(1e-13, 1e-5));
}

/* E7.9: the boundary of a free component moves it as a rigid body, against no stiffness: none below zero is left by
   rounding, which a body refuses. */
TEST(boundaries_that_move_a_free_component_have_no_negative_stiffness)
{
  static const fb_coordinate boundary[3] = {{0, 0}, {0, 1}, {0, 5}};
  for (int elements = 1; elements <= 6; elements++) {
    for (int size = 1; size <= 5; size++) {
      fb_modes_desc *keep;
      uniform_desc(elements, FB_ROOT_FREE);
      desc.length = (fb_real)(0.3 * size);
      desc.station[0].EI_y = desc.station[0].GJ = FB_R(0.0);
      keep = choice();
      keep->basis = FB_BASIS_COMPONENT;
      keep->cubic = size % 2;
      keep->count[FB_KIND_BEND_Y] = 1;
      keep->n_boundary = 3;
      memcpy(keep->boundary, boundary, sizeof boundary);
      FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
      for (int k = 0; k < 3; k++) {
        const double stiffness = (double)modes.K[k * (modes.n + 1)];
        FBT_TRUE(stiffness >= 0.0);
        FBT_BELOW(stiffness, FBT_TOL(1e-9, 1e-2) * (double)modes.K[3 * (modes.n + 1)]);
      }
    }
  }
}

/* E7.9: a cantilever of 20 elements with its tip as boundary and k modes with the tip held: under a force and a moment
   at the tip the reduced model deflects as the beam, F L^3/3EI, F L^2/2EI, M L/EI; it has its first k frequencies to
   2e-3, and to 1e-6 (asked: 1e-4) with the shapes of boundary inertia. */
TEST(components_deflect_exactly_at_their_boundary)
{
  enum { MOST = 12 };
  const int elements = (int)FBT_TOL(20, 4);
  double largest[2] = {0.0, 0.0};
  uniform_desc(elements, FB_ROOT_CLAMPED);
  FBT_INT_EQ(solve(&other, 6, 0, 0, 0), FB_OK);
  for (int run = 0; run < 10; run++) {
    static fb_real K[MOST * MOST], M[MOST * MOST], scale[MOST], d[MOST], X[MOST * MOST];
    static int perm[MOST];
    const int k = run / 2 + 1, inertia = run % 2;
    fb_modes_desc *keep = choice();
    keep->basis = FB_BASIS_COMPONENT;
    keep->count[FB_KIND_BEND_Y] = k;
    keep->boundary_inertia = inertia;
    keep->n_boundary = 2;
    keep->boundary[0].node = keep->boundary[1].node = elements;
    keep->boundary[0].axis = 1;
    keep->boundary[1].axis = 5;
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
    FBT_TRUE(FB_SINGLE ? modes.n >= k + 2 : modes.n == k + 2 + 2 * inertia); /* small corrections drown in single */
    memcpy(K, modes.K, sizeof(fb_real) * (size_t)(modes.n * modes.n));
    memcpy(M, modes.M, sizeof(fb_real) * (size_t)(modes.n * modes.n));
    FBT_INT_EQ(fb_lu_factor(K, perm, scale, modes.n), FB_OK);
    for (int load = 0; load < 2; load++) {
      fb_real f[MOST] = {0}, q[MOST];
      f[load] = FB_R(1.0);
      fb_lu_solve(q, K, perm, f, modes.n);
      FBT_NEAR_REL(q[0], load ? 4.0 / 14.0 : 8.0 / 21.0, FBT_TOL(1e-11, 1e-3));
      FBT_NEAR_REL(q[1], load ? 2.0 / 7.0 : 4.0 / 14.0, FBT_TOL(1e-11, 1e-3));
      for (int i = 2; i < modes.n; i++) {
        FBT_NEAR_ABS((double)(modes.K[i] / modes.K[i * (modes.n + 1)]), 0.0, FBT_TOL(1e-10, 1e-3));
      }
    }
    memcpy(K, modes.K, sizeof(fb_real) * (size_t)(modes.n * modes.n));
    FBT_INT_EQ(fb_eig_gen_solve(d, X, K, M, modes.n), FB_OK);
    for (int i = 0; i < k; i++) {
      largest[inertia] = fmax(largest[inertia], sqrt((double)d[i]) / (double)other.omega[i] - 1.0);
      FBT_BELOW(-FBT_TOL(1e-10, 1e-3), sqrt((double)d[i]) / (double)other.omega[i] - 1.0); /* from above */
    }
  }
  FBT_BELOW(largest[0], FBT_TOL(2e-3, 3e-3));
  FBT_BELOW(largest[1], FBT_TOL(1e-6, 3e-3));
  fbt_figure("Craig-Bampton, k modes: first k frequencies", "whole beam", largest[0]);
  fbt_figure("the same with boundary inertia", "whole beam", largest[1]);
}

/* E7.9, E6.9, E6.13: a cantilever with shear, all six coordinates of its tip as boundary and one mode: under each load
   there the reduced model deflects as Timoshenko's beam, L/EA, L^3/3EI + L/GA, L^2/2EI, L/EI, L/GJ, also by nodal
   coordinates alone, for any number of elements. */
TEST(components_with_shear_deflect_exactly_in_every_direction)
{
  static const fb_kind kind[6] = {FB_KIND_AXIAL,   FB_KIND_BEND_Y, FB_KIND_BEND_Z,
                                  FB_KIND_TORSION, FB_KIND_BEND_Z, FB_KIND_BEND_Y};
  static const int axis[6] = {4, 2, 0, 5, 1, 3};
  for (int run = 0; run < 8; run++) {
    const int cubic = run % 2, elements = run / 2 + 1 + cubic;   /* one cubic element has no coordinates left */
    const double stiffness[4] = {11.0, 7.0, 5.0, 13.0}, L = 2.0; /* EA, EI_z, EI_y, GJ; GA 0.6 and 0.4 times EI */
    double exact[6][6] = {{0.0}};
    fb_real K[7 * 7], scale[7], q[7];
    int perm[7];
    fb_modes_desc *keep;
    uniform_desc(elements, FB_ROOT_CLAMPED);
    desc.station[0].GA_y = FB_R(4.2);
    desc.station[0].GA_z = FB_R(2.0);
    desc.station[0].i_y = desc.station[0].i_z = FB_R(0.05);
    keep = choice();
    keep->basis = FB_BASIS_COMPONENT;
    keep->cubic = cubic;
    keep->count[FB_KIND_BEND_Y] = 1;
    keep->n_boundary = 6;
    for (int i = 0; i < 6; i++) {
      keep->boundary[i].node = elements;
      keep->boundary[i].axis = axis[i];
    }
    exact[0][0] = L / stiffness[0];
    exact[3][3] = L / stiffness[3];
    for (int plane = 0; plane < 2; plane++) { /* u_y with theta_z, u_z with -theta_y */
      const int u = 1 + plane, turn = 5 - plane;
      const double EI = stiffness[1 + plane], GA = plane ? 2.0 : 4.2;
      exact[u][u] = L * L * L / (3.0 * EI) + L / GA;
      exact[turn][turn] = L / EI;
      exact[u][turn] = exact[turn][u] = (plane ? -1.0 : 1.0) * L * L / (2.0 * EI);
    }
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
    FBT_INT_EQ(modes.n, 7);
    for (int i = 0; i < 6; i++) {
      FBT_NEAR_ABS(modes.omega[i], 0.0, 0.0);
      FBT_INT_EQ(modes.kind[i], kind[axis[i]]);
    }
    memcpy(K, modes.K, sizeof K);
    FBT_INT_EQ(fb_lu_factor(K, perm, scale, 7), FB_OK);
    for (int load = 0; load < 6; load++) {
      fb_real f[7] = {FB_R(0.0)};
      f[load] = FB_R(1.0);
      fb_lu_solve(q, K, perm, f, 7);
      for (int i = 0; i < 6; i++) {
        FBT_NEAR_ABS(q[i], exact[axis[load]][axis[i]], FBT_TOL(1e-11, 1e-3));
      }
    }
  }
}

/* Sum of psi^2/omega^2 at the tip along an axis: its flexibility. */
static double tip_sum(const fb_modes *in, int axis)
{
  double sum = 0.0;
  for (int a = 0; a < in->n; a++) {
    sum += pow((double)in->shape[a * in->ndof + 6 * desc.n_element + axis] / (double)in->omega[a], 2.0);
  }
  return sum;
}

/* E7.8: two modes and the static correction of a tip force: the sum of psi^2/omega^2 is the tip flexibility, L^3/3EI of
   the cantilever; of the free beam in its accelerated frame L^3/105EI (sum 4/(beta L)^4 over cos cosh = 1). Shear adds
   L/GA, and 2L/15GA: int V^2/GA of V = 3 s^2 - 2 s. Without the correction some percent are missing. A second load at the
   same place changes nothing. */
TEST(static_corrections_make_loads_exact)
{
  for (int run = 0; run < 12; run++) {
    const int free_root = run / 2 % 2, corrected = run % 2, sheared = run >= 4, plane = run >= 8;
    const double GA = 10.0, shear = sheared ? 2.0 / GA * (free_root ? 2.0 / 15.0 : 1.0) : 0.0;
    const double exact = 8.0 / (plane ? 5.0 : 7.0) / (free_root ? 105.0 : 3.0) + shear;
    fb_modes_desc *keep;
    uniform_desc((int)ELEMENTS, free_root ? FB_ROOT_FREE : FB_ROOT_CLAMPED);
    desc.station[0].GA_y = desc.station[0].GA_z = sheared ? (fb_real)GA : FB_R(0.0);
    keep = choice();
    keep->count[plane ? FB_KIND_BEND_Z : FB_KIND_BEND_Y] = 2;
    keep->n_load = corrected;
    keep->load[0].node = (int)ELEMENTS;
    keep->load[0].axis = 1 + plane;
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
    FBT_INT_EQ(modes.n, 2 + corrected);
    for (int a = 0; a < modes.n; a++) {
      FBT_NEAR_REL(modes.K[a * (modes.n + 1)], pow((double)modes.omega[a], 2.0), 8.0 * EPS);
    }
    if (corrected) {
      FBT_NEAR_REL(tip_sum(&modes, 1 + plane), exact, FBT_TOL(1e-10, 2e-3));
      FBT_NEAR_REL(modes.omega[1], other.omega[1], FBT_TOL(1e-10, 1e-4)); /* the natural modes stay */
    } else {
      FBT_BELOW(tip_sum(&modes, 1 + plane) / exact, free_root ? 0.96 : sheared ? 0.999 : 0.9976);
      other = modes;
    }
  }
}

/* E7.9, E6.3: all nodes of a uniform clamped beam as boundary, as many as there is room for: its stiffness is that
   of the finite-element coordinates, to which the shapes inside of elements add nothing. */
TEST(a_component_of_all_nodes_has_the_stiffness_of_the_elements)
{
  fb_modes_desc *keep;
  uniform_desc(4, FB_ROOT_CLAMPED);
  desc.station[0].i_y = desc.station[0].i_z = FB_R(0.05);
  keep = choice();
  for (int k = 0; k < FB_KIND_COUNT; k++) {
    keep->count[k] = FB_ALL_MODES;
  }
  keep->basis = FB_BASIS_ELEMENTS;
  FBT_INT_EQ(fb_modes_solve(&other, &work, &beam, keep), FB_OK);
  memset(keep->count, 0, sizeof keep->count);
  keep->basis = FB_BASIS_COMPONENT;
  keep->n_boundary = 24;
  for (int k = 0; k < 24; k++) {
    keep->boundary[k].node = 1 + k / 6;
    keep->boundary[k].axis = k % 6;
  }
  FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
  FBT_INT_EQ(modes.n, 24);
  for (int ab = 0; ab < 24 * 24; ab++) {
    const double size = sqrt((double)other.K[ab / 24 * 25] * (double)other.K[ab % 24 * 25]);
    FBT_NEAR_ABS(modes.K[ab], other.K[ab], FBT_TOL(1e-12, 1e-4) * size);
  }
}

/* E7.8: one mode and the correction are at the tip as flexible as all modes of a beam of few elements, whatever its shear,
   taper and root: what its inertia does to a free one is of third degree along it. */
TEST(one_mode_and_its_correction_are_as_good_as_all)
{
  for (int run = 0; run < 8; run++) {
    const int free_root = run % 2, plane = run / 2 % 2, elements = run / 4 + 1;
    const fb_kind kind = plane ? FB_KIND_BEND_Z : FB_KIND_BEND_Y;
    fb_modes_desc *keep;
    uniform_desc(elements, free_root ? FB_ROOT_FREE : FB_ROOT_CLAMPED);
    desc.station[0].i_y = desc.station[0].i_z = FB_R(0.05);
    desc.station[0].GA_y = desc.station[0].GA_z = FB_R(2.0);
    desc.n_station = 2;
    desc.station[1] = desc.station[0];
    desc.station[1].x = FB_R(2.0);
    desc.station[1].mass = FB_R(1.0);
    keep = choice();
    keep->count[kind] = 8 * elements;
    FBT_INT_EQ(fb_modes_solve(&other, &work, &beam, keep), FB_OK);
    keep->count[kind] = 1;
    keep->n_load = 1;
    keep->load[0].node = elements;
    keep->load[0].axis = 1 + plane;
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
    FBT_INT_EQ(modes.n, 2);
    FBT_NEAR_REL(tip_sum(&modes, 1 + plane), tip_sum(&other, 1 + plane), FBT_TOL(1e-11, 1e-3));
  }
}

/* E7.2: the lowest modes of all kinds are those that counts find, of a clamped and, behind its rigid ones, of a free beam;
   also where it is soft along its axis, or about it. */
TEST(the_lowest_modes_are_the_lowest_of_all_kinds)
{
  for (int run = 0; run < 6; run++) {
    const int root = run % 2 ? (int)FB_ROOT_FREE : 0, rigid = run % 2 ? 6 : 0;
    fb_modes_desc *keep;
    uniform_desc(5, (fb_root)root);
    desc.station[0].i_y = desc.station[0].i_z = FB_R(0.05);
    *(run / 2 == 1 ? &desc.station[0].GJ : &desc.station[0].EA) /= run < 2 ? FB_R(1.0) : FB_R(10.0);
    FBT_INT_EQ(solve(&other, 5, 5, 6, 6), FB_OK);
    for (int n = 1; n <= 7; n++) {
      keep = choice();
      keep->lowest = n;
      keep->rigid = 1;
      FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
      FBT_INT_EQ(modes.n, n + rigid);
      for (int k = 0; k < n; k++) {
        FBT_NEAR_REL(modes.omega[rigid + k], other.omega[k], FBT_TOL(1e-12, 1e-5));
        FBT_INT_EQ(modes.kind[rigid + k], other.kind[k]);
      }
    }
    keep->spin = FB_R(1.0);
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_ERR_VALUE);
    keep->spin = FB_R(0.0);
    keep->lowest = FB_MAX_MODES + 1;
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_ERR_CAPACITY);
  }
}

/* E7.2: the lowest modes under a limit are as many as asked for, or all below it, of all kinds together. */
TEST(the_lowest_modes_below_a_limit_are_all_below_it)
{
  fb_modes_desc *keep;
  uniform_desc(1, FB_ROOT_CLAMPED);
  FBT_INT_EQ(solve(&other, 2, 2, 2, 0), FB_OK);
  keep = choice();
  keep->omega_limit = FB_R(0.5) * (other.omega[2] + other.omega[3]);
  for (int lowest = 1; lowest <= FB_MAX_MODES; lowest++) {
    keep->lowest = lowest;
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
    FBT_INT_EQ(modes.n, lowest < 3 ? lowest : 3);
    for (int k = 0; k < modes.n; k++) {
      FBT_NEAR_REL(modes.omega[k], other.omega[k], FBT_TOL(1e-12, 1e-5));
      FBT_INT_EQ(modes.kind[k], other.kind[k]);
    }
  }
}

/* E7.7: bending of a uniform cantilever: effective masses 0.6131, 0.1883, 0.0647, 0.0331, 0.0200 of its modes
   (textbook), so that 0.9 of it takes five; sums rise with every mode and end below one, axially at 8/pi^2 (1 + 1/9 +
   ..). */
TEST(effective_masses_add_up_to_the_beam)
{
  static const double part[5] = {0.6131, 0.1883, 0.0647, 0.0331, 0.0200};
  fb_modes_desc *keep;
  double before = 0.0;
  uniform_desc((int)ELEMENTS, FB_ROOT_CLAMPED);
  desc.station[0].i_y = desc.station[0].i_z = FB_R(0.0);
  keep = choice();
  keep->count[FB_KIND_BEND_Y] = 1;
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
  FBT_NEAR_ABS(modes.rigid_mass[3] + modes.effective[3], 0.0, 0.0); /* a line does not turn about itself */
  desc.station[0].i_y = FB_R(0.01);
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  for (int n = 1; n <= 5; n++) {
    keep->count[FB_KIND_BEND_Y] = n;
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
    FBT_NEAR_ABS((double)modes.effective[1] - before, part[n - 1], 1e-4);
    FBT_NEAR_REL(modes.rigid_mass[1], 6.0, FBT_TOL(1e-12, 1e-5));
    FBT_NEAR_REL(modes.rigid_mass[5], 8.0, FBT_TOL(1e-12, 1e-5)); /* m L^2/3 */
    FBT_NEAR_ABS(modes.effective[0] + modes.effective[2], 0.0, 0.0);
    before = (double)modes.effective[1];
  }
  keep->count[FB_KIND_BEND_Y] = keep->count[FB_KIND_BEND_Z] = keep->count[FB_KIND_AXIAL] = FB_ALL_MODES;
  keep->count[FB_KIND_TORSION] = FB_ALL_MODES;
  keep->mass_fraction = FB_R(0.9);
  FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
  FBT_INT_EQ(modes.n, 5 + 5 + 2 + 2);
  for (int i = 0; i < 6; i++) {
    FBT_TRUE(modes.effective[i] >= FB_R(0.9) && modes.effective[i] < FB_R(1.0));
  }
  FBT_NEAR_REL(modes.effective[0], 8.0 / (pi * pi) * (1.0 + 1.0 / 9.0), 1e-4);
  desc.n_lump = 1; /* a body on the clamped root changes nothing */
  desc.lump[0].mass = FB_R(100.0);
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
  FBT_INT_EQ(modes.n, 5 + 5 + 2 + 2);
  keep->count[FB_KIND_BEND_Y] = 3; /* no more than asked for, and that is not enough */
  FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_ERR_KIND);
}

/* x_a^T M x_b with the assembled mass that the solution leaves in work. */
static double modal_mass(int a, int b)
{
  double sum = 0.0;
  for (int i = 0; i < modes.ndof; i++) {
    for (int j = 0; j < modes.ndof; j++) {
      sum += (double)modes.shape[a * modes.ndof + i] * (double)work.M[i * modes.ndof + j] *
             (double)modes.shape[b * modes.ndof + j];
    }
  }
  return sum;
}

/* E7.6: a free beam as a component: its rigid motions first, with all of its mass and inertia, none of it in the
   elastic modes; a pinned root leaves two rotations. */
TEST(components_keep_their_rigid_motions)
{
  static const int rigid[3] = {0, 2, 6};
  static const fb_kind kind[6] = {FB_KIND_AXIAL,   FB_KIND_BEND_Y, FB_KIND_BEND_Z,
                                  FB_KIND_TORSION, FB_KIND_BEND_Z, FB_KIND_BEND_Y};
  for (int root = 0; root < 3; root++) {
    fb_modes_desc *keep;
    uniform_desc(4, (fb_root)root);
    desc.station[0].i_y = desc.station[0].i_z = FB_R(0.02);
    keep = choice();
    keep->count[FB_KIND_BEND_Y] = keep->count[FB_KIND_BEND_Z] = 2;
    keep->count[FB_KIND_AXIAL] = keep->count[FB_KIND_TORSION] = 1;
    keep->rigid = 1;
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
    FBT_INT_EQ(modes.n, 6 + rigid[root]);
    for (int a = 0; a < modes.n; a++) {
      FBT_TRUE((modes.omega[a] > FB_R(0.1)) == (a >= rigid[root]));
      FBT_TRUE(a >= rigid[root] ||
               modes.kind[a] == kind[6 - rigid[root] + a]); /* those of free roots, then of pinned ones */
      for (int i = 0; i < 6 && root == FB_ROOT_FREE; i++) {
        const double share = pow((double)modes.momentum[6 * a + i], 2.0) / (double)modes.rigid_mass[i];
        FBT_TRUE(a < 6 || share < FBT_TOL(1e-18, 1e-8));
      }
      for (int b = 0; b < modes.n; b++) {
        FBT_NEAR_ABS(modal_mass(a, b), a == b, FBT_TOL(1e-12, 1e-4));
      }
    }
    for (int i = 0; i < 6 && root == FB_ROOT_FREE; i++) {
      FBT_NEAR_REL(modes.effective[i], 1.0, FBT_TOL(1e-12, 1e-4));
    }
  }
}

/* E7.10, E6.6: Euler's loads (p06_euler.csv) of four end conditions, in both planes; the column under its own weight, w
   L^3 = 7.83735 EI; two and three times the lowest load's roots for the higher ones of the cantilever, (2k-1)^2. */
TEST(columns_buckle_under_the_published_loads)
{
  static const char *const ends[4] = {"clamped-free", "pinned-pinned", "clamped-pinned", "clamped-clamped"};
  const fbt_table *table = fbt_reference("p06_euler.csv");
  double largest = 0.0;
  for (int k = 0; k < 4; k++) {
    fb_modes_desc *keep;
    double critical = 0.0;
    for (int row = 0; row < table->rows; row++) {
      critical = strcmp(fbt_word(table, row, "case"), ends[k]) == 0 ? fbt_value(table, row, "p_cr") : critical;
    }
    uniform_desc((int)ELEMENTS, k == 1 ? FB_ROOT_PINNED : FB_ROOT_CLAMPED);
    keep = choice();
    keep->lowest = k == 0 ? 4 : 2;
    keep->preload.force = -FB_R(3.0);
    keep->n_boundary = k == 0 ? 0 : k == 3 ? 4 : 2;
    for (int i = 0; i < 4; i++) {
      keep->boundary[i].node = (int)ELEMENTS;
      keep->boundary[i].axis = i < 2 ? 1 + i : 2 + i;
    }
    FBT_INT_EQ(fb_buckling_solve(&modes, &work, &beam, keep), FB_OK);
    for (int plane = 0; plane < 2; plane++) { /* EI_y = 5 is the softer one */
      const double load = critical * (plane ? 7.0 : 5.0) / 4.0 / 3.0;
      FBT_NEAR_REL(modes.omega[plane], load, FBT_TOL(1e-8, 1e-3));
      FBT_INT_EQ(modes.kind[plane], plane ? FB_KIND_BEND_Y : FB_KIND_BEND_Z);
      largest = fmax(largest, fabs((double)modes.omega[plane] / load - 1.0));
    }
    if (k == 0) {
      FBT_NEAR_REL(modes.omega[2] / modes.omega[0], 9.0, FBT_TOL(1e-7, 1e-3));
      keep->preload.force = FB_R(3.0); /* a pull never buckles */
      FBT_INT_EQ(fb_buckling_solve(&modes, &work, &beam, keep), FB_ERR_KIND);
      desc.station[0].tension_y = FB_R(0.02);
      desc.station[0].twist = FB_R(0.3);
      FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
      FBT_INT_EQ(fb_buckling_solve(&modes, &work, &beam, keep), FB_ERR_KIND);
      uniform_desc((int)ELEMENTS, FB_ROOT_CLAMPED);
      FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
      memset(&keep->preload, 0, sizeof keep->preload);
      FBT_INT_EQ(fb_buckling_solve(&modes, &work, &beam, keep), FB_ERR_VALUE);
      keep->preload.acceleration = -FB_R(1.0);
      keep->lowest = 0;
      FBT_INT_EQ(fb_buckling_solve(&modes, &work, &beam, keep), FB_OK);
      FBT_INT_EQ(modes.n, 1);
      FBT_NEAR_REL(modes.omega[0], 7.83734744 * 5.0 / (3.0 * 8.0), FBT_TOL(1e-8, 1e-3));
    }
  }
  fbt_figure("Euler buckling, four end conditions", "closed form (p06)", largest);
}

/* E6.6, E7.2: a beam pulled by F with both ends pinned is a string with stiffness, omega_k^2 = (k pi/L)^2/m (F + EI (k
   pi/L)^2); pushed beyond buckling it is refused; pushed to half, softer by sqrt(1/2). */
TEST(preload_changes_the_frequencies_as_in_a_stiff_string)
{
  static const double pull[4] = {0.0, 20.0, -0.5, -1.01};
  for (int k = 0; k < 4; k++) {
    const double wave = pi / 2.0, force = pull[k] > 0.0 ? pull[k] : pull[k] * 5.0 * wave * wave;
    fb_modes_desc *keep;
    uniform_desc((int)ELEMENTS, FB_ROOT_PINNED);
    desc.station[0].EI_z = FB_R(0.0); /* it would turn about its root */
    keep = choice();
    keep->basis = FB_BASIS_COMPONENT;
    keep->count[FB_KIND_BEND_Z] = 2;
    keep->preload.force = (fb_real)force;
    keep->n_boundary = 1;
    keep->boundary[0].node = (int)ELEMENTS;
    keep->boundary[0].axis = 2;
    if (k == 3) {
      FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_ERR_SINGULAR);
      continue;
    }
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
    for (int i = 1; i <= 2; i++) {
      const double w2 = pow(i * wave, 2.0);
      FBT_NEAR_REL(modes.omega[i], sqrt(w2 / 3.0 * (force + 5.0 * w2)), FBT_TOL(1e-7, 1e-3));
    }
  }
}

/* The shapes of an element as polynomials in s = 0..1 (E6.1, E6.5): what moves (0 u_x, 1 u_y, 2 u_z, 3 theta_x),
   with which power of the element length and sign (u_z has the slope -theta_y), and the coefficients. */
typedef struct shape_polynomial {
  int component, slope;
  double sign, c[6];
} shape_polynomial;
static const shape_polynomial element[20] = {
    {0, 0, 1, {1, -1, 0, 0, 0, 0}},         {1, 0, 1, {1, 0, -3, 2, 0, 0}},         {2, 0, 1, {1, 0, -3, 2, 0, 0}},
    {3, 0, 1, {1, -1, 0, 0, 0, 0}},         {2, 1, -1, {0, 1, -2, 1, 0, 0}},        {1, 1, 1, {0, 1, -2, 1, 0, 0}},
    {0, 0, 1, {0, 1, 0, 0, 0, 0}},          {1, 0, 1, {0, 0, 3, -2, 0, 0}},         {2, 0, 1, {0, 0, 3, -2, 0, 0}},
    {3, 0, 1, {0, 1, 0, 0, 0, 0}},          {2, 1, -1, {0, 0, -1, 1, 0, 0}},        {1, 1, 1, {0, 0, -1, 1, 0, 0}},
    {1, 0, 1, {0, 0, 16, -32, 16, 0}},      {1, 0, 1, {0, 0, -64, 256, -320, 128}}, {2, 0, 1, {0, 0, 16, -32, 16, 0}},
    {2, 0, 1, {0, 0, -64, 256, -320, 128}}, {0, 0, 1, {0, 4, -4, 0, 0, 0}},         {0, 0, 1, {0, -8, 24, -16, 0, 0}},
    {3, 0, 1, {0, 4, -4, 0, 0, 0}},         {3, 0, 1, {0, -8, 24, -16, 0, 0}}};

/* int over a..b of u^(order) v^(order) (p0 + p1 s + p2 s^2) ds */
static double polynomial_integral(const double *u, const double *v, int order, const double *p, double a, double b)
{
  double sum = 0.0;
  for (int i = order; i < 6; i++) {
    for (int j = order; j < 6; j++) {
      double factor = u[i] * v[j];
      for (int k = 0; k < order; k++) {
        factor *= (i - k) * (j - k);
      }
      for (int k = 0; k < 3; k++) {
        const int power = i + j - 2 * order + k + 1;
        sum += factor * p[k] * (pow(b, power) - pow(a, power)) / power;
      }
    }
  }
  return sum;
}

static double full_K[MAX_DOF * MAX_DOF], full_M[MAX_DOF * MAX_DOF];

static int full_dofs(void)
{
  return 14 * desc.n_element + 6;
}

/* Adds element e between its fractions a and b, properties linear from section *s to *t, with the tension c0 + c1 x +
   c2 x^2. */
static void full_add_cell(int e, double a, double b, const fb_section *s, const fb_section *t, const double tension[3])
{
  const int n = full_dofs(), nodes = 6 * (desc.n_element + 1);
  const double l = (double)desc.length / desc.n_element, x0 = (double)s->x, span = (double)t->x - x0;
  const double from[7] = {(double)s->EA,   (double)s->EI_z, (double)s->EI_y, (double)s->GJ,
                          (double)s->mass, (double)s->i_y,  (double)s->i_z};
  const double to[7] = {(double)t->EA,   (double)t->EI_z, (double)t->EI_y, (double)t->GJ,
                        (double)t->mass, (double)t->i_y,  (double)t->i_z};
  const double T[3] = {tension[0] + e * l * (tension[1] + e * l * tension[2]),
                       l * (tension[1] + 2 * e * l * tension[2]), l * l * tension[2]};
  double p[7][3];
  for (int i = 0; i < 7; i++) {
    const double slope = span > 0.0 ? (to[i] - from[i]) / span : 0.0;
    p[i][0] = from[i] + slope * (e * l - x0);
    p[i][1] = slope * l;
    p[i][2] = 0.0;
  }
  for (int i = 0; i < 20; i++) {
    for (int j = 0; j < 20; j++) {
      const shape_polynomial *u = &element[i], *v = &element[j];
      const int at = (i < 12 ? 6 * e + i : nodes + 8 * e + i - 12) * n + (j < 12 ? 6 * e + j : nodes + 8 * e + j - 12);
      const double scale = u->sign * v->sign * pow(l, u->slope + v->slope);
      if (u->component != v->component) {
        continue;
      }
      if (u->component == 1 || u->component == 2) {
        full_K[at] += scale / (l * l * l) * polynomial_integral(u->c, v->c, 2, p[u->component], a, b);
        full_K[at] += scale / l * polynomial_integral(u->c, v->c, 1, T, a, b);
        full_M[at] += scale * l * polynomial_integral(u->c, v->c, 0, p[4], a, b);
        full_M[at] += scale / l * polynomial_integral(u->c, v->c, 1, p[u->component == 1 ? 6 : 5], a, b);
      } else {
        full_K[at] += scale / l * polynomial_integral(u->c, v->c, 1, p[u->component], a, b);
        full_M[at] += u->component == 0 ? scale * l * polynomial_integral(u->c, v->c, 0, p[4], a, b) : 0.0;
        full_M[at] += u->component == 3 ? scale * l * polynomial_integral(u->c, v->c, 0, p[5], a, b) : 0.0;
        full_M[at] += u->component == 3 ? scale * l * polynomial_integral(u->c, v->c, 0, p[6], a, b) : 0.0;
      }
    }
  }
}

/* Kinetic energy (bilinear) of a lumped body whose node moves by unit i and unit j: velocities of its center and
   spins. */
static double lump_mass(const fb_lump *lump, int i, int j)
{
  const fb_real *J = lump->inertia;
  const double c[3] = {(double)lump->center[0], (double)lump->center[1], (double)lump->center[2]};
  const double own[9] = {(double)J[0], (double)J[3], (double)J[4], (double)J[3], (double)J[1],
                         (double)J[5], (double)J[4], (double)J[5], (double)J[2]};
  double v[2][3], sum = 0.0;
  for (int side = 0; side < 2; side++) {
    const int k = side ? j : i;
    for (int a = 0; a < 3; a++) { /* e_k x c: component a */
      const int r = k - 3;
      v[side][a] = k < 3 ? a == k : a == (r + 1) % 3 ? -c[(r + 2) % 3] : a == (r + 2) % 3 ? c[(r + 1) % 3] : 0.0;
    }
  }
  for (int a = 0; a < 3; a++) {
    sum += (double)lump->mass * v[0][a] * v[1][a];
  }
  return sum + (i >= 3 && j >= 3 ? own[3 * (i - 3) + j - 3] : 0.0);
}

/* full_K and full_M of desc, all shapes, no root condition. */
static void full_matrices(const double tension[3])
{
  const int n = full_dofs();
  memset(full_K, 0, sizeof full_K);
  memset(full_M, 0, sizeof full_M);
  for (int e = 0; e < desc.n_element; e++) {
    const double l = (double)desc.length / desc.n_element;
    if (desc.n_station == 1) {
      full_add_cell(e, 0.0, 1.0, &desc.station[0], &desc.station[0], tension);
    }
    for (int k = 0; k + 1 < desc.n_station; k++) {
      const double a = fmax(0.0, (double)desc.station[k].x / l - e);
      const double b = fmin(1.0, (double)desc.station[k + 1].x / l - e);
      if (a < b) {
        full_add_cell(e, a, b, &desc.station[k], &desc.station[k + 1], tension);
      }
    }
  }
  for (int k = 0; k < desc.n_lump; k++) {
    const int at = 6 * desc.lump[k].node;
    for (int i = 0; i < 36; i++) {
      full_M[(at + i / 6) * n + at + i % 6] += lump_mass(&desc.lump[k], i / 6, i % 6);
    }
  }
}

static double form(const double *A, const fb_real *y, const fb_real *z)
{
  const int n = full_dofs();
  double sum = 0.0;
  for (int i = 0; i < n; i++) {
    double row = 0.0;
    for (int j = 0; j < n; j++) {
      row += A[i * n + j] * (double)z[j];
    }
    sum += (double)y[i] * row;
  }
  return sum;
}

/* Five stations, two bodies off the axis: every kind of motion is coupled with every other. */
static void coupled_desc(int n_element, fb_root root)
{
  static const fb_lump lump[2] = {{0,
                                   FB_R(1.3),
                                   {FB_R(-0.1), FB_R(0.2), FB_R(0.3)},
                                   {FB_R(0.3), FB_R(0.4), FB_R(0.5), FB_R(-0.1), FB_R(0.05), FB_R(0.08)}},
                                  {0,
                                   FB_R(0.8),
                                   {FB_R(0.1), FB_R(-0.3), FB_R(0.2)},
                                   {FB_R(0.3), FB_R(0.2), FB_R(0.25), FB_R(0.05), FB_R(-0.02), FB_R(0.01)}}};
  uniform_desc(n_element, root);
  desc.n_station = 5;
  for (int k = 4; k >= 0; k--) {
    static const double x[5] = {0.0, 0.26, 1.0, 1.15, 2.0};
    fb_section *s = &desc.station[k];
    *s = desc.station[0];
    s->x = (fb_real)x[k];
    s->mass *= (fb_real)(1.0 + 0.4 * fbt_random());
    s->EA *= (fb_real)(1.0 + 0.4 * fbt_random());
    s->GJ *= (fb_real)(1.0 + 0.4 * fbt_random());
    s->EI_y *= (fb_real)(1.0 + 0.4 * fbt_random());
    s->EI_z *= (fb_real)(1.0 + 0.4 * fbt_random());
    s->i_y = (fb_real)(0.1 + 0.04 * fbt_random());
    s->i_z = (fb_real)(0.1 + 0.04 * fbt_random());
  }
  desc.n_lump = 2;
  desc.lump[0] = lump[0];
  desc.lump[0].node = n_element;
  desc.lump[1] = lump[1];
  desc.lump[1].node = n_element / 2;
}

/* Is this degree of freedom held, by the root condition or because its kind has no stiffness, which means rigid? */
static int is_held(int dof)
{
  const fb_section *s = &desc.station[0];
  const fb_real stiffness[4] = {s->EA, s->EI_z, s->EI_y, s->GJ};
  const int nodes = 6 * (desc.n_element + 1);
  const shape_polynomial *p = &element[dof < nodes ? dof % 6 : 12 + (dof - nodes) % 8];
  return (dof < 6 && desc.root != FB_ROOT_FREE && (desc.root == FB_ROOT_CLAMPED || dof < 4)) ||
         !(stiffness[p->component] > FB_R(0.0));
}

static const double no_tension[3] = {0.0, 0.0, 0.0};

/* X M X^T = 1, X K X^T = omega^2, K x = omega^2 M x in every free coordinate (in units of the largest term of the row),
   held coordinates still, tip displacement of the mode's kind positive, ascending. */
static void modes_are_right(const fb_modes *in)
{
  static const int main_dof[FB_KIND_COUNT] = {1, 2, 0, 3};
  const int n = full_dofs();
  FBT_INT_EQ(in->ndof, n);
  full_matrices(no_tension);
  for (int a = 0; a < in->n; a++) {
    const fb_real *x = in->shape + a * n;
    const double omega = (double)in->omega[a];
    FBT_TRUE(x[6 * desc.n_element + main_dof[in->kind[a]]] > FB_R(0.0));
    FBT_TRUE(a == 0 || in->omega[a] >= in->omega[a - 1]);
    for (int b = 0; b < in->n; b++) {
      const fb_real *y = in->shape + b * n;
      const double k = form(full_K, x, y) / (omega * (double)in->omega[b]);
      FBT_NEAR_ABS(form(full_M, x, y), a == b, FBT_TOL(2e-13, 5e-6));
      FBT_NEAR_ABS(k, a == b, FBT_TOL(1e-12, 1e-4));
      FBT_NEAR_ABS(in->M[a * in->n + b], a == b, 0.0);
      FBT_NEAR_REL(in->K[a * in->n + b], a == b ? omega * omega : 0.0, 4.0 * EPS);
    }
    for (int i = 0; i < n; i++) {
      double residual = 0.0, size = 0.0;
      for (int j = 0; j < n; j++) {
        const double k = full_K[i * n + j] * (double)x[j], m = omega * omega * full_M[i * n + j] * (double)x[j];
        residual += k - m;
        size += fabs(k) + fabs(m);
      }
      if (is_held(i)) {
        FBT_TRUE(x[i] >= FB_R(0.0) && x[i] <= FB_R(0.0));
      } else {
        FBT_NEAR_ABS(residual, 0.0, FBT_TOL(1e-9, 3e-3) * size);
      }
    }
  }
}

/* Nodal values of a rigid motion along (0 to 2) or about (3 to 5) an axis of the root. */
static void rigid_motion(fb_real *rigid, int axis)
{
  memset(rigid, 0, sizeof *rigid * (size_t)full_dofs());
  for (int node = 0; node <= desc.n_element; node++) {
    const fb_real at = desc.length * (fb_real)node / (fb_real)desc.n_element;
    rigid[6 * node + axis] = FB_R(1.0);
    rigid[6 * node + 2] -= axis == 4 ? at : FB_R(0.0);
    rigid[6 * node + 1] += axis == 5 ? at : FB_R(0.0);
  }
}

/* Rigid motions the root leaves free carry no momentum in a mode. */
static void modes_are_free_of_rigid_motion(const fb_modes *in)
{
  const int n = full_dofs();
  for (int axis = 0; axis < 6; axis++) {
    static fb_real rigid[MAX_DOF];
    if (desc.root == FB_ROOT_CLAMPED || (desc.root == FB_ROOT_PINNED && axis < 4)) {
      continue;
    }
    rigid_motion(rigid, axis);
    for (int a = 0; a < in->n; a++) {
      const double overlap = form(full_M, in->shape + a * n, rigid) / sqrt(form(full_M, rigid, rigid));
      FBT_NEAR_ABS(overlap, 0.0, FBT_TOL(1e-12, 1e-4));
    }
  }
}

/* E7.3, E7.2, E7.1: mass normal, diagonal stiffness, eigenvectors coordinate by coordinate, sign at the tip, free of
   rigid motion; the same bits twice, whatever was in the output and the work before. Beams with every coupling, each
   root. */
TEST(modes_are_orthonormal_with_a_fixed_sign)
{
  for (int root = 0; root < 3; root++) {
    for (int coupled = 0; coupled < 2; coupled++) {
      const int n = 3;
      fbt_seed(1);
      coupled_desc(n, (fb_root)root);
      if (!coupled) {
        desc.n_lump = 0;
      }
      memset(&modes, 0xA5, sizeof modes);
      memset(&work, 0xA5, sizeof work);
      FBT_INT_EQ(solve(&modes, 3, 3, 2, 2), FB_OK);
      FBT_INT_EQ(modes.n, 10);
      modes_are_right(&modes);
      modes_are_free_of_rigid_motion(&modes);
      memset(&other, 0, sizeof other);
      memset(&work, 0, sizeof work);
      FBT_INT_EQ(solve(&other, 3, 3, 2, 2), FB_OK);
      FBT_INT_EQ(other.n, modes.n);
      FBT_TRUE(memcmp(other.kind, modes.kind, sizeof(fb_kind) * 10) == 0);
      FBT_TRUE(memcmp(other.omega, modes.omega, sizeof(fb_real) * 10) == 0);
      FBT_TRUE(memcmp(other.shape, modes.shape, sizeof(fb_real) * (size_t)(10 * modes.ndof)) == 0);
      FBT_TRUE(memcmp(other.K, modes.K, sizeof(fb_real) * 100) == 0);
      FBT_TRUE(memcmp(other.M, modes.M, sizeof(fb_real) * 100) == 0);
    }
  }
}

/* E7.7: what a unit rate of a coordinate has of momentum and angular momentum about the root, the beam's mass and
   moments of inertia and the part p^T M^-1 p of them that all coordinates move, by the matrices integrated here:
   each basis of finite elements, every coupling, each root. */
TEST(momenta_and_effective_masses_are_those_of_the_whole_beam)
{
  static const fb_basis basis[3] = {FB_BASIS_MODES, FB_BASIS_ELEMENTS, FB_BASIS_COMPONENT};
  static fb_real rigid[MAX_DOF], inverse[FB_MAX_MODES * FB_MAX_MODES];
  for (int run = 0; run < 9; run++) {
    fb_modes_desc *keep;
    fbt_seed(1);
    coupled_desc(2, (fb_root)(run % 3));
    keep = choice();
    keep->basis = basis[run / 3];
    for (int k = 0; k < FB_KIND_COUNT; k++) {
      keep->count[k] = 2 + (k == FB_KIND_BEND_Z);
    }
    for (int k = 0; k < 6 && keep->basis == FB_BASIS_COMPONENT; k++) {
      keep->boundary[keep->n_boundary].node = 2;
      keep->boundary[keep->n_boundary++].axis = k;
    }
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
    FBT_TRUE(modes.n >= 9);
    full_matrices(no_tension);
    memcpy(inverse, modes.M, sizeof(fb_real) * (size_t)(modes.n * modes.n));
    FBT_INT_EQ(fb_chol_factor(inverse, modes.n), FB_OK);
    for (int i = 0; i < 6; i++) {
      fb_real x[FB_MAX_MODES], p[FB_MAX_MODES];
      double inertia, part = 0.0;
      rigid_motion(rigid, i);
      inertia = form(full_M, rigid, rigid);
      FBT_NEAR_REL(modes.rigid_mass[i], inertia, FBT_TOL(1e-12, 1e-5));
      for (int a = 0; a < modes.n; a++) {
        const double momentum = form(full_M, modes.shape + a * modes.ndof, rigid);
        FBT_NEAR_ABS(modes.momentum[6 * a + i], momentum, FBT_TOL(1e-12, 1e-4) * sqrt(inertia));
        p[a] = (fb_real)momentum;
      }
      fb_chol_solve(x, inverse, p, modes.n);
      for (int a = 0; a < modes.n; a++) {
        part += (double)p[a] * (double)x[a];
      }
      FBT_NEAR_ABS(modes.effective[i], part / inertia, FBT_TOL(1e-12, 1e-4));
    }
  }
}

/* E6.4, E7.2: which kinds of motion a body at the tip couples with which: its center beside the axis extension with
   bending and twist with bending across, its products of inertia twist with bending or both planes. Coordinates that
   are not coupled stay exactly still in each other's modes, those that are move. */
TEST(bodies_couple_the_kinds_that_they_should)
{
  static const int group[5][4] = {
      {0, 0, 1, 1}, {0, 1, 0, 1}, {0, 1, 2, 2}, {0, 1, 2, 1}, {0, 1, 1, 2}}; /* u_x, u_y, u_z, theta_x */
  static const int component[FB_KIND_COUNT] = {1, 2, 0, 3};
  for (int k = 0; k < 5; k++) {
    const int root = k % 3;
    double moves[3][3] = {{0.0}};
    uniform_desc(2, (fb_root)root);
    desc.station[0].i_y = desc.station[0].i_z = FB_R(0.05);
    desc.n_lump = 1;
    desc.lump[0].node = 2;
    desc.lump[0].mass = FB_R(2.0);
    for (int i = 0; i < 3; i++) {
      desc.lump[0].inertia[i] = FB_R(0.4);
    }
    *(k < 2 ? &desc.lump[0].center[1 + k] : &desc.lump[0].inertia[1 + k]) = FB_R(-0.1);
    FBT_INT_EQ(solve(&modes, 3, 3, 3, 3), FB_OK);
    FBT_INT_EQ(modes.n, 12);
    modes_are_right(&modes);
    for (int a = 0; a < modes.n; a++) {
      const int own = group[k][component[modes.kind[a]]];
      for (int i = 0; i < 18; i++) {
        moves[own][group[k][element[i % 6].component]] += fabs((double)modes.shape[a * modes.ndof + i]);
      }
    }
    for (int i = 0; i < 9; i++) {
      FBT_TRUE(i / 3 == i % 3 || moves[i / 3][i % 3] <= 0.0);
    }
  }
}

/* E7.3: where a heavy body holds the tip the largest displacement of a node takes its place, so that rounding at the
   tip does not choose the sign. */
TEST(a_held_tip_does_not_choose_the_sign)
{
  if (FB_SINGLE) {
    return; /* the squares of the frequencies differ by more than single precision tells apart */
  }
  uniform_desc(4, FB_ROOT_CLAMPED);
  desc.n_lump = 1;
  desc.lump[0].node = 4;
  desc.lump[0].mass = FB_R(1e6);
  FBT_INT_EQ(solve(&modes, 4, 4, 0, 0), FB_OK);
  for (int k = 0; k < modes.n; k++) {
    const int u = modes.kind[k] == FB_KIND_BEND_Y ? 1 : 2;
    double largest = 0.0;
    for (int node = 0; node <= 4; node++) {
      const double x = (double)modes.shape[k * modes.ndof + 6 * node + u];
      largest = fabs(x) > fabs(largest) ? x : largest;
    }
    FBT_BELOW(0.0, largest);
    FBT_TRUE(k < 2 ||
             fabs((double)modes.shape[k * modes.ndof + 24 + u]) < 1e-3 * largest); /* but the mode of the body */
  }
}

/* E7.2, E7.3: a round section bends alike in both planes, to the bit but for the sign of the slopes, and its planes
   do not mix; equal frequencies come in the order of the kinds. */
TEST(a_round_beam_has_pairs_of_unmixed_modes)
{
  for (int root = 0; root < 3; root++) {
    uniform_desc(5, (fb_root)root);
    desc.station[0].EI_z = desc.station[0].EI_y;
    desc.station[0].i_y = desc.station[0].i_z = FB_R(0.1);
    FBT_INT_EQ(solve(&modes, 4, 4, 0, 0), FB_OK);
    FBT_INT_EQ(modes.n, 8);
    modes_are_right(&modes);
    for (int k = 0; k < 8; k++) {
      const fb_real *x = modes.shape + k * modes.ndof, *pair = modes.shape + (k ^ 1) * modes.ndof;
      FBT_INT_EQ(modes.kind[k], k % 2 ? FB_KIND_BEND_Z : FB_KIND_BEND_Y);
      FBT_NEAR_REL(modes.omega[k], modes.omega[k ^ 1], 0.0);
      for (int i = 0; i < modes.ndof; i++) {
        const shape_polynomial *p = &element[i < 36 ? i % 6 : 12 + (i - 36) % 8];
        const int mirror = i >= 36 ? (k % 2 ? i - 2 : i + 2) : i % 6 > 3 ? i + 9 - 2 * (i % 6) : i + 3 - 2 * (i % 6);
        if (p->component != (int)modes.kind[k] + 1) {
          FBT_NEAR_ABS(x[i], 0.0, 0.0);
        } else {
          FBT_NEAR_ABS(x[i], (p->slope ? -1.0 : 1.0) * (double)pair[mirror], 0.0);
        }
      }
    }
  }
}

/* E6.4, E7.3: a tip body beside the axis couples twist with bending across: both are found, labelled and
   orthonormal, each moves in the other's coordinates, and neither in those of the uncoupled kinds. Stiff in bending,
   the beam twists as a shaft with the inertia about its own axis, moved there by Steiner. */
TEST(a_body_beside_the_axis_couples_bending_and_torsion)
{
  uniform_desc(4, FB_ROOT_CLAMPED);
  desc.station[0].i_y = desc.station[0].i_z = FB_R(0.05);
  desc.n_lump = 1;
  desc.lump[0].node = 4;
  desc.lump[0].mass = FB_R(2.0);
  desc.lump[0].center[1] = FB_R(0.5);
  for (int i = 0; i < 3; i++) {
    desc.lump[0].inertia[i] = FB_R(0.25);
  }
  desc.station[0].EA = FB_R(0.0); /* else the body couples extension with bending along y, too */
  FBT_INT_EQ(solve(&modes, 2, 3, 0, 3), FB_OK);
  FBT_INT_EQ(modes.n, 8);
  modes_are_right(&modes);
  for (int k = 0; k < modes.n; k++) {
    const fb_real *tip = modes.shape + k * modes.ndof + 24;
    if (modes.kind[k] == FB_KIND_BEND_Y) {
      FBT_NEAR_ABS(fabs((double)tip[2]) + fabs((double)tip[3]) + fabs((double)tip[4]), 0.0, 0.0);
    } else {
      FBT_BELOW(0.01, fabs((double)tip[2]));
      FBT_BELOW(0.01, fabs((double)tip[3]));
      FBT_NEAR_ABS(fabs((double)tip[0]) + fabs((double)tip[1]) + fabs((double)tip[5]), 0.0, 0.0);
    }
  }
  FBT_INT_EQ(solve(&modes, 0, 0, 0, 1), FB_OK);
  FBT_INT_EQ(modes.n, 1);
  FBT_INT_EQ(modes.kind[0], FB_KIND_TORSION);
  desc.station[0].EI_y = FB_R(0.0); /* rigid */
  FBT_INT_EQ(solve(&modes, 0, 0, 0, 1), FB_OK);
  frequency_is_near((double)modes.omega[0], 0.5 * tan_root(1, 0.2 / 0.75) * sqrt(13.0 / 0.1), 3, 0.1);
}

/* E7.2: massless coordinates are harmless: a beam without mass and a tip body have the modes of the body alone, one per
   direction it can move in, and no more. Closed forms: springs 3 EI/L^3, EA/L, GJ/L. */
TEST(a_beam_without_mass_has_the_modes_of_its_tip_body)
{
  uniform_desc(3, FB_ROOT_CLAMPED);
  desc.station[0].mass = FB_R(0.0);
  desc.n_lump = 1;
  desc.lump[0].node = 3;
  desc.lump[0].mass = FB_R(4.0);
  FBT_INT_EQ(solve(&modes, 1, 1, 1, 0), FB_OK);
  FBT_NEAR_REL(omega_of(&modes, FB_KIND_BEND_Y, 1), sqrt(3.0 * 7.0 / (8.0 * 4.0)), FBT_TOL(1e-12, 1e-5));
  FBT_NEAR_REL(omega_of(&modes, FB_KIND_BEND_Z, 1), sqrt(3.0 * 5.0 / (8.0 * 4.0)), FBT_TOL(1e-12, 1e-5));
  FBT_NEAR_REL(omega_of(&modes, FB_KIND_AXIAL, 1), sqrt(11.0 / (2.0 * 4.0)), FBT_TOL(1e-12, 1e-5));
  FBT_INT_EQ(solve(&other, 2, 0, 0, 0), FB_ERR_KIND);
  FBT_INT_EQ(solve(&other, 0, 0, 2, 0), FB_ERR_KIND);
  FBT_INT_EQ(solve(&other, 0, 0, 0, 1), FB_ERR_KIND);
  desc.lump[0].inertia[0] = FB_R(0.5);
  desc.lump[0].inertia[1] = FB_R(0.5);
  desc.lump[0].inertia[2] = FB_R(0.5);
  FBT_INT_EQ(solve(&modes, FB_ALL_MODES, FB_ALL_MODES, FB_ALL_MODES, FB_ALL_MODES), FB_OK);
  FBT_INT_EQ(modes.n, 6);
  FBT_NEAR_REL(omega_of(&modes, FB_KIND_TORSION, 1), sqrt(13.0 / (2.0 * 0.5)), FBT_TOL(1e-12, 1e-5));
  for (int k = 1; k <= 2; k++) { /* (12 EI/L^3 - m o2) (4 EI/L - j o2) = (6 EI/L^2)^2 */
    const double b = 0.5 * (12.0 * 7.0 / 8.0 / 4.0 + 4.0 * 7.0 / 2.0 / 0.5), c = 12.0 * 7.0 * 7.0 / 16.0 / (4.0 * 0.5);
    const double o2 = k == 1 ? c / (b + sqrt(b * b - c)) : b + sqrt(b * b - c);
    FBT_NEAR_REL(omega_of(&modes, FB_KIND_BEND_Y, k), sqrt(o2), FBT_TOL(1e-12, 1e-5));
  }
}

/* The beam in other units, of length, mass and time. */
static void desc_in_units(double l, double m, double t)
{
  desc.length *= (fb_real)l;
  for (int k = 0; k < desc.n_station; k++) {
    fb_section *s = &desc.station[k];
    s->x *= (fb_real)l;
    s->mass *= (fb_real)(m / l);
    s->EA *= (fb_real)(m * l / (t * t));
    s->GJ *= (fb_real)(m * l * l * l / (t * t));
    s->EI_y *= (fb_real)(m * l * l * l / (t * t));
    s->EI_z *= (fb_real)(m * l * l * l / (t * t));
    s->i_y *= (fb_real)(m * l);
    s->i_z *= (fb_real)(m * l);
  }
  for (int k = 0; k < desc.n_lump; k++) {
    desc.lump[k].mass *= (fb_real)m;
    for (int j = 0; j < 6; j++) {
      desc.lump[k].center[j % 3] *= j < 3 ? (fb_real)l : FB_R(1.0);
      desc.lump[k].inertia[j] *= (fb_real)(m * l * l);
    }
  }
}

/* Three bending modes of both planes, two along and about the line, and corrections for loads on the tip, along z,
   about y, z; or these modes behind the tip as boundary, pushed by more than it bears where it may move across. */
static fb_status modes_in_units(fb_modes *out, int component, double l, double m, double t)
{
  fb_modes_desc *keep;
  desc_in_units(l, m, t);
  keep = choice();
  keep->count[FB_KIND_BEND_Y] = keep->count[FB_KIND_BEND_Z] = 3;
  keep->count[FB_KIND_AXIAL] = keep->count[FB_KIND_TORSION] = 2;
  keep->n_load = component ? 0 : 3;
  keep->n_boundary = component ? 4 : 0;
  keep->basis = component ? FB_BASIS_COMPONENT : FB_BASIS_MODES;
  keep->preload.force = (fb_real)((component ? -16.0 : 0.0) * m * l / (t * t));
  for (int k = 0; k < 4; k++) {
    static const int axis[4] = {2, 4, 5, 1};
    keep->load[k].node = keep->boundary[k].node = 2;
    keep->load[k].axis = keep->boundary[k].axis = axis[k];
  }
  return fb_modes_solve(out, &work, &beam, keep);
}

/* Section 7, E7.8, E7.9: a beam in other units of length, mass and time, powers of two, has the same frequencies,
   those of static corrections, too, and a component the same stiffness at its boundary, below zero where it buckles:
   no threshold has a unit. Free and pinned roots, where the shift of E7.1 must follow, with all kinds coupled and
   with none. */
TEST(frequencies_do_not_depend_on_the_units)
{
  static const int unit[5][3] = {
      {12, 0, 0}, {-12, -10, 0}, {0, 12, -6}, {6, -12, 8}, {0, -40, 8}}; /* powers: length, mass, time */
  for (int run = 0; run < 9; run++) {
    const int root = run % 3, component = run >= 6; /* 0 to 2 coupled, 3 to 5 not */
    if (component && root == FB_ROOT_FREE) {
      continue; /* its boundary would leave rigid motion */
    }
    for (int i = -1; i < FBT_COUNT(unit); i++) {
      const double l = i < 0 ? 1.0 : ldexp(1.0, unit[i][0]), m = i < 0 ? 1.0 : ldexp(1.0, unit[i][1]);
      const double t = i < 0 ? 1.0 : ldexp(1.0, unit[i][2]);
      fbt_seed(1);
      coupled_desc(2, (fb_root)root);
      desc.n_lump = run < 3 ? desc.n_lump : 0;
      FBT_INT_EQ(modes_in_units(&modes, component, l, m, t), FB_OK);
      other = i < 0 ? modes : other;
      FBT_INT_EQ(modes.n, other.n);
      for (int k = 0; k < modes.n; k++) {
        const double unit_k = (component && k < 4 ? m * (k % 3 ? l * l : 1.0) : 1.0) / (t * t);
        FBT_NEAR_REL((double)modes.omega[k] * t, other.omega[k], FBT_TOL(1e-11, 1e-3));
        FBT_INT_EQ(modes.kind[k], other.kind[k]);
        FBT_NEAR_REL((double)modes.K[k * (modes.n + 1)] / unit_k, other.K[k * (modes.n + 1)], FBT_TOL(1e-11, 1e-3));
      }
    }
    FBT_TRUE(!component || other.K[0] < FB_R(0.0));
  }
}

/* Section 7: counts and the frequency limit select from one ordered list. */
TEST(modes_are_selected_by_count_and_frequency)
{
  static fb_modes_desc keep;
  int count[FB_KIND_COUNT] = {0};
  uniform_desc(3, FB_ROOT_CLAMPED);
  desc.station[0].i_y = desc.station[0].i_z = FB_R(0.05);
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  memset(&keep, 0, sizeof keep);
  for (int k = 0; k < FB_KIND_COUNT; k++) {
    keep.count[k] = FB_ALL_MODES;
  }
  keep.omega_limit = FB_R(18.0);
  FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, &keep), FB_OK);
  FBT_INT_EQ(modes.n, 12);
  for (int k = 0; k < modes.n; k++) {
    count[modes.kind[k]]++;
    FBT_TRUE(k == 0 || modes.omega[k] > modes.omega[k - 1]);
    FBT_BELOW(modes.omega[k], 18.0);
  }
  FBT_INT_EQ(count[FB_KIND_BEND_Y], 2);
  FBT_INT_EQ(count[FB_KIND_BEND_Z], 3);
  FBT_INT_EQ(count[FB_KIND_AXIAL], 6);
  FBT_INT_EQ(count[FB_KIND_TORSION], 1);
  FBT_INT_EQ(solve(&other, 2, 3, 6, 1), FB_OK); /* the same by counts */
  FBT_INT_EQ(other.n, 12);
  FBT_TRUE(memcmp(other.omega, modes.omega, sizeof(fb_real) * 12) == 0);
  FBT_TRUE(memcmp(other.shape, modes.shape, sizeof(fb_real) * (size_t)(12 * modes.ndof)) == 0);
  FBT_INT_EQ(solve(&other, 1, 2, 0, 1), FB_OK); /* the lowest of each kind */
  FBT_INT_EQ(other.n, 4);
  FBT_TRUE(omega_of(&other, FB_KIND_BEND_Y, 1) == omega_of(&modes, FB_KIND_BEND_Y, 1));
  FBT_TRUE(omega_of(&other, FB_KIND_BEND_Z, 2) == omega_of(&modes, FB_KIND_BEND_Z, 2));
  FBT_TRUE(omega_of(&other, FB_KIND_TORSION, 1) == omega_of(&modes, FB_KIND_TORSION, 1));
  for (int last = 0; last < 11; last++) {
    keep.omega_limit = FB_R(0.5) * (modes.omega[last] + modes.omega[last + 1]);
    FBT_INT_EQ(fb_modes_solve(&other, &work, &beam, &keep), FB_OK);
    FBT_INT_EQ(other.n, last + 1);
    FBT_TRUE(memcmp(other.omega, modes.omega, sizeof(fb_real) * (size_t)other.n) == 0);
    FBT_TRUE(memcmp(other.kind, modes.kind, sizeof(fb_kind) * (size_t)other.n) == 0);
  }
  keep.omega_limit = FB_R(0.5) * modes.omega[0]; /* none */
  FBT_INT_EQ(fb_modes_solve(&other, &work, &beam, &keep), FB_OK);
  FBT_INT_EQ(other.n, 0);
  keep.count[FB_KIND_BEND_Y] = 1; /* a count under a limit is an upper bound */
  FBT_INT_EQ(fb_modes_solve(&other, &work, &beam, &keep), FB_OK);
  FBT_INT_EQ(other.n, 0);
  FBT_INT_EQ(solve(&other, 0, 0, 0, 0), FB_OK);
  FBT_INT_EQ(other.n, 0);
}

/* Section 7: finite-element coordinates are unit shapes, M and K those of fb_beam_matrices without the held and the
   unwanted rows. */
TEST(element_coordinates_keep_the_element_matrices)
{
  static const fb_kind nodal[6] = {FB_KIND_AXIAL,   FB_KIND_BEND_Y, FB_KIND_BEND_Z,
                                   FB_KIND_TORSION, FB_KIND_BEND_Z, FB_KIND_BEND_Y};
  static fb_real K[MAX_DOF * MAX_DOF], M[MAX_DOF * MAX_DOF];
  for (int root = 0; root < 3; root++) {
    for (int set = 1; set < 16; set++) { /* which kinds */
      static fb_modes_desc keep;
      int dof[18], n = 0;
      fbt_seed(1);
      coupled_desc(2, (fb_root)root);
      memset(&keep, 0, sizeof keep);
      keep.basis = FB_BASIS_ELEMENTS;
      for (int k = 0; k < FB_KIND_COUNT; k++) {
        keep.count[k] = set >> k & 1 ? FB_ALL_MODES : 0;
      }
      for (int i = 0; i < 18; i++) {
        if (set >> nodal[i % 6] & 1 && !is_held(i)) {
          dof[n++] = i;
        }
      }
      FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
      if (n > FB_MAX_MODES) {
        FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, &keep), FB_ERR_CAPACITY);
        continue;
      }
      FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, &keep), FB_OK);
      fb_beam_matrices(K, M, &beam);
      FBT_INT_EQ(modes.n, n);
      FBT_INT_EQ(modes.ndof, full_dofs());
      for (int a = 0; a < n; a++) {
        FBT_INT_EQ(modes.kind[a], nodal[dof[a] % 6]);
        FBT_NEAR_ABS(modes.omega[a], 0.0, 0.0);
        for (int i = 0; i < modes.ndof; i++) {
          FBT_NEAR_ABS(modes.shape[a * modes.ndof + i], i == dof[a], 0.0);
        }
        for (int b = 0; b < n; b++) {
          FBT_NEAR_REL(modes.M[a * n + b], M[dof[a] * 18 + dof[b]], 0.0);
          FBT_NEAR_REL(modes.K[a * n + b], K[dof[a] * 18 + dof[b]], 0.0);
        }
      }
    }
  }
}

/* The lowest eigenvalue mu = 1/omega^2 of the bending along z of the full matrices, clamped root. */
static double full_bend_z_omega(void)
{
  enum { MAX = 4 * FB_MAX_ELEMENTS };
  static fb_real k[MAX * MAX], m[MAX * MAX], X[MAX * MAX], d[MAX];
  int dof[MAX], n = 0;
  for (int i = 6; i < full_dofs(); i++) {
    const int nodes = 6 * (desc.n_element + 1);
    if (element[i < nodes ? i % 6 : 12 + (i - nodes) % 8].component == 2) {
      dof[n++] = i;
    }
  }
  for (int i = 0; i < n * n; i++) {
    k[i] = (fb_real)full_K[dof[i / n] * full_dofs() + dof[i % n]];
    m[i] = (fb_real)full_M[dof[i / n] * full_dofs() + dof[i % n]];
  }
  FBT_INT_EQ(fb_eig_gen_solve(d, X, m, k, n), FB_OK);
  return 1.0 / sqrt((double)d[n - 1]);
}

/* Two modes at rest and two at the spin in modes: mass normal, stiffness diagonal with the frequencies at rest; under
   tension the lowest frequencies of the four go to omega[2]. */
static void spin_modes_are_right(double omega[2], double spin, double radius, const double tension[3])
{
  static fb_modes_desc keep;
  fb_real k[16], V[16], d[4];
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Z] = 4;
  keep.spin = (fb_real)spin;
  keep.spin_radius = (fb_real)radius;
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, &keep), FB_OK);
  FBT_INT_EQ(modes.n, 4);
  full_matrices(tension);
  for (int a = 0; a < 4; a++) {
    FBT_INT_EQ(modes.kind[a], FB_KIND_BEND_Z);
    FBT_TRUE(a == 0 || modes.omega[a] > modes.omega[a - 1]);
    for (int b = 0; b < 4; b++) {
      const fb_real *x = modes.shape + a * modes.ndof, *y = modes.shape + b * modes.ndof;
      k[4 * a + b] = (fb_real)form(full_K, x, y);
      FBT_NEAR_ABS(form(full_M, x, y), a == b, FBT_TOL(1e-11, 1e-3));
    }
  }
  FBT_INT_EQ(fb_eig_sym_solve(d, V, k, 4), FB_OK);
  omega[0] = sqrt((double)d[0]);
  omega[1] = sqrt((double)d[1]);
  full_matrices(no_tension);
  for (int a = 0; a < 4; a++) {
    for (int b = 0; b < 4; b++) {
      const double omega2 = (double)modes.omega[a] * (double)modes.omega[b];
      const double got = form(full_K, modes.shape + a * modes.ndof, modes.shape + b * modes.ndof);
      FBT_NEAR_ABS(got / omega2, a == b, FBT_TOL(2e-11, 1e-4));
    }
  }
}

/* E6.6, E7.4: with a spin the modes are Ritz modes of the beam at rest that hold two modes at rest and two under
   tension, so that with the tension T = spin^2 m (L - x) (r + (L + x)/2) added here four of them have the two lowest
   published frequencies (p02_rotating_uniform.csv, out of plane) up to eta = 12, and without it the two lowest at
   rest. A tip body adds spin^2 m_t (r + L + c_x), the sign of the spin nothing; its reference are the full matrices. */
TEST(modes_for_a_spin_hold_the_modes_under_tension)
{
  const fbt_table *table = fbt_reference("p02_rotating_uniform.csv");
  const double unit = sqrt(5.0 / 48.0);
  double omega[2];
  int rows = 0;
  uniform_desc((int)ELEMENTS, FB_ROOT_CLAMPED);
  for (int row = 0; row < table->rows; row++) {
    const double eta = fbt_value(table, row, "eta"), r = 2.0 * fbt_value(table, row, "alpha");
    const double o2 = eta * eta * 5.0 / 48.0; /* [rad^2/s^2] */
    const double tension[3] = {3.0 * o2 * (2.0 * r + 2.0), -3.0 * o2 * r, -1.5 * o2};
    const int mode = (int)fbt_value(table, row, "mode");
    if (mode <= 2 && eta > 2.0 && eta <= 12.0) {
      spin_modes_are_right(omega, row % 2 ? sqrt(o2) : -sqrt(o2), r, tension);
      FBT_NEAR_REL(omega[mode - 1], fbt_value(table, row, "mu_flap") * unit, FBT_TOL(5e-8, 1e-3));
      FBT_NEAR_REL(modes.omega[0], 3.516015268500151 * unit, FBT_TOL(1e-8, 1e-4));
      FBT_NEAR_REL(modes.omega[1], 22.03449156466677 * unit, FBT_TOL(1e-8, 1e-4));
      rows++;
    }
  }
  FBT_INT_EQ(rows, 60);
  desc.n_lump = 1;
  desc.lump[0].node = desc.n_element;
  desc.lump[0].mass = FB_R(4.0);
  desc.lump[0].center[0] = FB_R(0.5);
  {
    const double o2 = 4.0, r = 0.25; /* two modes at rest come close, 1e-2 */
    const double tension[3] = {3.0 * o2 * (2.0 * r + 2.0) + 4.0 * o2 * (r + 2.5), -3.0 * o2 * r, -1.5 * o2};
    spin_modes_are_right(omega, 2.0, r, tension);
    full_matrices(tension);
    FBT_NEAR_REL(omega[0], full_bend_z_omega(), FBT_TOL(1e-9, 2e-3));
  }
}

/* E6.6: the pull at the tip, the field and the spin act together on the beam and on the body at its tip, F + m (L -
   x) (a + s^2 (r + (L + x)/2)) + m_t (a + s^2 (r + L + c_x)): the lowest mode of the matrices with that tension.
   What sits on the root pulls at nothing. */
TEST(preloads_add_up_to_the_tension)
{
  fb_modes_desc *keep;
  uniform_desc((int)ELEMENTS, FB_ROOT_CLAMPED);
  desc.n_lump = 2;
  desc.lump[0].node = desc.n_element;
  desc.lump[0].mass = FB_R(4.0);
  desc.lump[0].center[0] = FB_R(0.5);
  desc.lump[1].mass = FB_R(70.0);
  for (int run = 0; run < 4; run++) {
    const double F = run == 1 ? 0.0 : 3.0, a = run == 2 ? 0.0 : 2.0, s2 = run == 3 ? 0.0 : 2.25, r = 0.25;
    const double tension[3] = {F + 3.0 * (2.0 * a + s2 * (2.0 * r + 2.0)) + 4.0 * (a + s2 * (r + 2.5)),
                               -3.0 * (a + s2 * r), -1.5 * s2};
    keep = choice();
    keep->count[FB_KIND_BEND_Z] = 1;
    keep->preload.force = (fb_real)F;
    keep->preload.acceleration = (fb_real)a;
    keep->preload.spin = (fb_real)-sqrt(s2);
    keep->preload.spin_radius = (fb_real)r;
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
    full_matrices(tension);
    FBT_NEAR_REL(modes.omega[0], full_bend_z_omega(), FBT_TOL(1e-10, 2e-3));
  }
}

/* E7.10, E6.6: a column without mass that carries a body at half its height buckles below it, as a cantilever of
   that length under its weight, pi^2 EI/4 (L/2)^2; what hangs below the body bears nothing. */
TEST(columns_buckle_below_the_body_that_they_carry)
{
  fb_modes_desc *keep;
  uniform_desc((int)FBT_TOL(8, 4), FB_ROOT_CLAMPED);
  desc.station[0].mass = FB_R(0.0);
  desc.n_lump = 1;
  desc.lump[0].node = desc.n_element / 2;
  desc.lump[0].mass = FB_R(4.0);
  keep = choice();
  keep->lowest = 2;
  keep->preload.acceleration = -FB_R(0.5);
  FBT_INT_EQ(fb_buckling_solve(&modes, &work, &beam, keep), FB_OK);
  FBT_NEAR_REL(modes.omega[0], pi * pi * 5.0 / 4.0 / 2.0, FBT_TOL(1e-8, 1e-3));
  FBT_NEAR_REL(modes.omega[1], pi * pi * 7.0 / 4.0 / 2.0, FBT_TOL(1e-8, 1e-3));
}

/* desc and keep are refused with the status, and the modes keep every byte. */
static void refused(const fb_modes_desc *keep, fb_status expected)
{
  memset(&pattern, 0xA5, sizeof pattern);
  memset(&modes, 0xA5, sizeof modes);
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), expected);
  FBT_TRUE(memcmp(&modes, &pattern, sizeof modes) == 0);
}

/* Section 7: what a beam cannot have is refused: kinds without stiffness or inertia, more modes than coordinates or
   capacity, numbers out of range; the output is left alone. */
TEST(modes_that_do_not_exist_are_refused)
{
  const fb_real bad[3] = {(fb_real)NAN, (fb_real)INFINITY, (fb_real)(4.0 * (double)FB_HUGE)};
  static fb_modes_desc keep;
  for (int kind = 0; kind < FB_KIND_COUNT; kind++) {
    for (int what = 0; what < 4;
         what++) { /* 0 no stiffness, 1 no inertia, 2 more than the element has, 3 elements, none */
      uniform_desc(1, FB_ROOT_CLAMPED);
      desc.station[0].i_y = desc.station[0].i_z = FB_R(0.05);
      memset(&keep, 0, sizeof keep);
      keep.count[kind] = 1;
      keep.basis = what == 3 ? FB_BASIS_ELEMENTS : FB_BASIS_MODES;
      if (what == 0 || what == 3) {
        fb_section *s = &desc.station[0];
        fb_real *stiffness[FB_KIND_COUNT] = {&s->EI_z, &s->EI_y, &s->EA, &s->GJ};
        *stiffness[kind] = FB_R(0.0);
      } else if (what == 1) { /* only twist can be without inertia; massless bending beams need a body */
        if (kind != FB_KIND_TORSION) {
          continue;
        }
        desc.station[0].i_y = desc.station[0].i_z = FB_R(0.0);
      } else {
        const int exist = kind == FB_KIND_BEND_Y || kind == FB_KIND_BEND_Z ? 4 : 3;
        keep.count[kind] = exist;
        FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
        FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, &keep), FB_OK);
        FBT_INT_EQ(modes.n, exist);
        keep.count[kind] = exist + 1;
      }
      refused(&keep, FB_ERR_KIND);
      if (what < 2) { /* "as many as there are": none */
        keep.count[kind] = FB_ALL_MODES;
        FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, &keep), FB_OK);
        FBT_INT_EQ(modes.n, 0);
      }
    }
  }
  uniform_desc(FB_MAX_ELEMENTS, FB_ROOT_CLAMPED); /* more than FB_MAX_MODES */
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_AXIAL] = FB_MAX_MODES + 1 < 3 * FB_MAX_ELEMENTS ? FB_MAX_MODES + 1 : FB_ALL_MODES;
  refused(&keep, FB_ERR_CAPACITY);
  keep.count[FB_KIND_AXIAL] = FB_ALL_MODES;
  refused(&keep, FB_ERR_CAPACITY);
  uniform_desc(2, FB_ROOT_CLAMPED);
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Z] = -1;
  refused(&keep, FB_ERR_VALUE);
  keep.count[FB_KIND_BEND_Z] = 1;
  keep.omega_limit = -FB_R(1.0);
  refused(&keep, FB_ERR_VALUE);
  keep.omega_limit = FB_R(0.0);
  memset(&keep.basis, 9, sizeof keep.basis); /* no basis */
  refused(&keep, FB_ERR_VALUE);
  keep.basis = FB_BASIS_ELEMENTS; /* a spin is for modes of clamped beams */
  keep.spin = FB_R(1.0);
  refused(&keep, FB_ERR_VALUE);
  keep.basis = FB_BASIS_FUNCTIONS;
  refused(&keep, FB_ERR_VALUE);
  keep.spin = FB_R(0.0);
  for (int degree = -1; degree < 10; degree++) {
    keep.degree = degree;
    if (degree != 0 && (degree < 3 || degree > 8)) {
      refused(&keep, FB_ERR_VALUE);
    }
  }
  keep.degree = 0;
  keep.root_strain = 1; /* without axial functions */
  refused(&keep, FB_ERR_KIND);
  keep.root_strain = 0;
  keep.count[FB_KIND_BEND_Z] = 5; /* two elements have four */
  refused(&keep, FB_ERR_KIND);
  keep.count[FB_KIND_BEND_Z] = 1;
  keep.count[FB_KIND_TORSION] = 1;
  refused(&keep, FB_ERR_KIND);
  keep.count[FB_KIND_TORSION] = 0;
  for (int root = FB_ROOT_PINNED; root <= FB_ROOT_FREE; root++) {
    uniform_desc(2, (fb_root)root);
    refused(&keep, FB_ERR_VALUE);
  }
  uniform_desc(2, FB_ROOT_CLAMPED);
  keep.spin = FB_R(1.0);
  keep.basis = FB_BASIS_MODES;
  for (int root = FB_ROOT_PINNED; root <= FB_ROOT_FREE; root++) {
    uniform_desc(2, (fb_root)root);
    refused(&keep, FB_ERR_VALUE);
  }
  uniform_desc(2, FB_ROOT_CLAMPED);
  for (int i = 0; i < 9; i++) {
    fb_real *field[3] = {&keep.omega_limit, &keep.spin, &keep.spin_radius};
    const fb_real before = *field[i / 3];
    *field[i / 3] = bad[i % 3];
    refused(&keep, FB_ERR_NOT_FINITE);
    *field[i / 3] = before;
  }
  uniform_desc(2, FB_ROOT_CLAMPED); /* no stiffness in the outer half: a mechanism */
  desc.n_station = 3;
  desc.station[2] = desc.station[1] = desc.station[0];
  desc.station[1].x = FB_R(0.75);
  desc.station[2].x = FB_R(2.0);
  desc.station[1].EI_y = desc.station[2].EI_y = FB_R(0.0);
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Z] = 1;
  refused(&keep, FB_ERR_SINGULAR);
  uniform_desc(2, FB_ROOT_CLAMPED);
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(NULL, &work, &beam, &keep), FB_ERR_NULL);
  FBT_INT_EQ(fb_modes_solve(&modes, NULL, &beam, &keep), FB_ERR_NULL);
  FBT_INT_EQ(fb_modes_solve(&modes, &work, NULL, &keep), FB_ERR_NULL);
  FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, NULL), FB_ERR_NULL);
  FBT_TRUE(memcmp(&modes, &pattern, sizeof modes) == 0);
}

/* Section 7: as many coordinates as there is room for, and no more: natural modes, with corrections behind them or
   rigid modes before, and boundaries before modes and what their inertia bends. */
TEST(modes_may_fill_all_their_room)
{
  for (int more = 0; more < 2; more++) {
    for (int run = 0; run < 5; run++) {
      static const int extra[5] = {0, 6, 6, 3, 12}; /* none, rigid modes, boundary, loads, boundary and its inertia */
      fb_modes_desc *keep;
      fb_status status;
      fbt_seed(1);
      coupled_desc(4, run == 1 ? FB_ROOT_FREE : FB_ROOT_CLAMPED);
      keep = choice();
      keep->lowest = FB_MAX_MODES - extra[run] + more;
      keep->rigid = run == 1;
      keep->basis = run == 2 || run == 4 ? FB_BASIS_COMPONENT : FB_BASIS_MODES;
      keep->n_boundary = keep->basis == FB_BASIS_COMPONENT ? 6 : 0;
      keep->n_load = run == 3 ? 3 : 0;
      keep->boundary_inertia = run == 4;
      for (int k = 0; k < 6; k++) {
        keep->load[k].node = keep->boundary[k].node = 4;
        keep->load[k].axis = keep->boundary[k].axis = k;
      }
      memset(&modes, 0xA5, sizeof modes);
      pattern = modes;
      status = fb_modes_solve(&modes, &work, &beam, keep);
      if (FB_SINGLE && run >= 3 &&
          status == FB_OK) { /* corrections that drown in rounding are left out, the rest is there */
        FBT_TRUE(modes.n >= keep->lowest + keep->n_boundary && modes.n <= FB_MAX_MODES);
        continue;
      }
      FBT_INT_EQ(status, more ? FB_ERR_CAPACITY : FB_OK);
      FBT_TRUE(more ? memcmp(&modes, &pattern, sizeof modes) == 0 : modes.n == FB_MAX_MODES);
    }
  }
}

/* E7.1, E7.6: the lowest modes of a beam that is free to move, or to turn, keep their digits on a fine mesh: the
   shift is of their size, whatever stiffness the mesh has, in each plane and along the beam, whose length is not
   one. */
TEST(free_beams_keep_the_digits_of_their_low_modes)
{
  static const double beta[2] = {3.92660231204792, 4.73004074486270};
  const int n = (int)FBT_TOL(FB_MAX_ELEMENTS, 4);
  for (int root = FB_ROOT_PINNED; root <= (int)FB_ROOT_FREE; root++) {
    const double b = beta[root - 1];
    uniform_desc(n, (fb_root)root);
    desc.length = FB_R(0.5);
    FBT_INT_EQ(solve(&modes, 1, 1, 1, 0), FB_OK);
    frequency_is_near(omega_of(&modes, FB_KIND_BEND_Y, 1), 4.0 * b * b * sqrt(7.0 / 3.0), 4, b / n);
    frequency_is_near(omega_of(&modes, FB_KIND_BEND_Z, 1), 4.0 * b * b * sqrt(5.0 / 3.0), 4, b / n);
    frequency_is_near(omega_of(&modes, FB_KIND_AXIAL, 1), root * pi * sqrt(11.0 / 3.0), 3, 0.5 * root * pi / n);
  }
}

/* A line with two kinks: three straight limbs of 2, 1 and 2 elements of length 1/2, each turned from the one before
   about an axis across it, all by `base`: their attitudes and the nodes of all elements. */
static const int limb_first[4] = {0, 2, 3, 5};
static void limbs_fill(fb_real attitude[3][4], fb_real node[6][3], const fb_real base[4])
{
  static const fb_real kink[3][4] = {{FB_R(1.0), FB_R(0.0), FB_R(0.0), FB_R(0.0)},
                                     {FB_R(0.9), FB_R(0.0), FB_R(0.0), FB_R(0.4)},
                                     {FB_R(0.9), FB_R(0.0), FB_R(-0.4), FB_R(0.0)}};
  memset(node, 0, 18 * sizeof(fb_real));
  for (int k = 0; k < 3; k++) {
    fb_real R[9];
    fb_quat_mul(attitude[k], k ? attitude[k - 1] : base, kink[k]);
    fb_quat_to_mat33(R, attitude[k]);
    for (int e = limb_first[k]; e < limb_first[k + 1]; e++) {
      for (int i = 0; i < 3; i++) {
        node[e + 1][i] = node[e][i] + FB_R(0.5) * R[3 * i];
      }
    }
  }
}

/* That line as a chain. */
static void kinked_desc(fb_root root)
{
  static const fb_real straight[4] = {FB_R(1.0), FB_R(0.0), FB_R(0.0), FB_R(0.0)};
  fb_real attitude[3][4];
  uniform_desc(5, root);
  desc.station[0].i_y = desc.station[0].i_z = FB_R(0.05);
  desc.n_point = 6;
  limbs_fill(attitude, desc.point, straight);
}

/* E6.11, E7.6: a free chain moves as the rigid body of its straight rods, m/3 (a a + a b + b b) across an axis of a
   rod from a to b, with what its sections have about themselves; its elastic modes have none of that. */
TEST(a_free_chain_has_the_inertia_of_its_rods)
{
  fb_modes_desc *keep;
  kinked_desc(FB_ROOT_FREE);
  keep = choice();
  keep->lowest = 4;
  keep->rigid = 1;
  FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
  FBT_INT_EQ(modes.n, 10);
  for (int axis = 0; axis < 3; axis++) {
    double inertia = 0.0;
    for (int e = 0; e < 5; e++) {
      for (int i = 0; i < 3; i++) {
        const double a = (double)desc.point[e][i], b = (double)desc.point[e + 1][i];
        inertia += i == axis ? 0.025 * (1.0 + 4.0 * (b - a) * (b - a)) : 0.5 * (a * a + a * b + b * b);
      }
    }
    FBT_NEAR_REL(modes.rigid_mass[axis], 7.5, FBT_TOL(1e-13, 1e-5));
    FBT_NEAR_REL(modes.rigid_mass[3 + axis], inertia, FBT_TOL(1e-13, 1e-5));
  }
  for (int i = 0; i < 6; i++) {
    FBT_NEAR_REL(modes.effective[i], 1.0, FBT_TOL(1e-12, 1e-4));
    for (int a = 6; a < modes.n; a++) {
      FBT_NEAR_ABS(modes.momentum[6 * a + i], 0.0, FBT_TOL(1e-11, 1e-3));
    }
  }
}

static fb_beam limb[3];
static fb_modes limb_basis[3], common[3];
static fb_join_work join_work;

/* Its limbs in an attitude of their own, component c the one with number order[c], with all finite-element
   coordinates. */
static void limbs_solve(const int order[3], fb_root root)
{
  static const fb_real base[4] = {FB_R(0.4), FB_R(-0.2), FB_R(0.7), FB_R(0.3)};
  fb_real attitude[3][4], node[6][3];
  limbs_fill(attitude, node, base);
  for (int c = 0; c < 3; c++) {
    const int k = order[c], elements = limb_first[k + 1] - limb_first[k];
    fb_modes_desc *keep;
    uniform_desc(elements, k == 0 ? root : FB_ROOT_FREE);
    desc.length = FB_R(0.5) * (fb_real)elements;
    desc.station[0].i_y = desc.station[0].i_z = FB_R(0.05);
    memcpy(desc.attitude, attitude[k], sizeof desc.attitude);
    memcpy(desc.position, node[limb_first[k]], sizeof desc.position);
    keep = choice();
    keep->basis = FB_BASIS_ELEMENTS;
    for (int kind = 0; kind < FB_KIND_COUNT; kind++) {
      keep->count[kind] = FB_ALL_MODES;
    }
    FBT_INT_EQ(fb_modes_solve(&limb_basis[c], &work, &beam, keep), FB_OK);
    limb[c] = beam;
  }
}

/* What the limbs of the common modes have at a weld, inertial axes: the same from both sides. */
static void weld_is_whole(const fb_weld *weld, int k)
{
  fb_real motion[2][6];
  for (int side = 0; side < 2; side++) {
    const int c = weld->component[side];
    const fb_real *const value = common[c].shape + k * common[c].ndof + 6 * weld->node[side];
    fb_mat33_mul_vec3(motion[side], limb[c].axes, value);
    fb_mat33_mul_vec3(motion[side] + 3, limb[c].axes, value + 3);
  }
  FBT_BELOW(fbt_difference(motion[0], motion[1], 6), FBT_TOL(1e-12, 1e-4));
}

/* E7.11, E7.12: limbs welded in space, named in any order, in any attitude of all, are the chain of the same
   elements: its frequencies, unit modal mass and frequencies squared of all limbs together, shapes that meet at the
   welds. */
TEST(welded_limbs_are_the_chain_of_their_elements)
{
  static const int order[3][3] = {{0, 1, 2}, {2, 0, 1}, {1, 2, 0}}, place[3][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}};
  for (int run = 0; run < 6; run++) {
    const int *const at = place[run / 2];
    const fb_root root = run % 2 ? FB_ROOT_FREE : FB_ROOT_CLAMPED;
    fb_weld weld[2] = {{{0, 0}, {2, 0}}, {{0, 0}, {0, 1}}};
    fb_status status;
    fb_modes_desc *keep;
    kinked_desc(root);
    keep = choice();
    keep->cubic = 1;
    keep->lowest = 9;
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
    limbs_solve(order[run / 2], root);
    weld[0].component[0] = at[0];
    weld[0].component[1] = weld[1].component[1] = at[1];
    weld[1].component[0] = at[2];
    status = fb_modes_join(common, &join_work, limb, limb_basis, 3, weld, 2, 9, FB_R(0.0));
    /* a free one's slow modes cannot be told from rigid ones in single precision, as the header says */
    FBT_INT_EQ(status, FB_SINGLE && root == FB_ROOT_FREE ? FB_ERR_CONVERGENCE : FB_OK);
    for (int a = 0; a < 9 && status == FB_OK; a++) {
      FBT_NEAR_REL(common[0].omega[a], modes.omega[a], FBT_TOL(1e-11, 1e-3));
      weld_is_whole(&weld[0], a);
      weld_is_whole(&weld[1], a);
      for (int b = 0; b < 9; b++) {
        double m = 0.0, k = 0.0;
        for (int c = 0; c < 3; c++) {
          m += (double)common[c].M[9 * a + b];
          k += (double)common[c].K[9 * a + b] / ((double)modes.omega[a] * (double)modes.omega[b]);
        }
        FBT_NEAR_ABS(m, a == b, FBT_TOL(1e-11, 1e-3));
        FBT_NEAR_ABS(k, a == b, FBT_TOL(1e-11, 1e-3));
      }
    }
  }
}

/* E7.12: a part alone, without a weld, keeps its modes in every coordinate, but for their sign. */
TEST(a_part_alone_keeps_its_modes)
{
  fbt_seed(1);
  coupled_desc(2, FB_ROOT_CLAMPED);
  FBT_INT_EQ(solve(&modes, 2, 2, 2, 3), FB_OK);
  FBT_INT_EQ(fb_modes_join(common, &join_work, &beam, &modes, 1, NULL, 0, 0, FB_R(0.0)), FB_OK);
  FBT_INT_EQ(common[0].n, modes.n);
  FBT_INT_EQ(common[0].ndof, modes.ndof);
  for (int a = 0; a < modes.n; a++) {
    const fb_real *const x = modes.shape + a * modes.ndof, *const y = common[0].shape + a * modes.ndof;
    const double sign = x[12] * y[12] < FB_R(0.0) ? -1.0 : 1.0, size = fbt_largest(x, modes.ndof);
    FBT_NEAR_REL(common[0].omega[a], modes.omega[a], FBT_TOL(1e-12, 1e-5));
    FBT_INT_EQ(common[0].kind[a], modes.kind[a]);
    for (int i = 0; i < modes.ndof; i++) {
      FBT_NEAR_ABS(y[i], sign * (double)x[i], FBT_TOL(1e-11, 1e-4) * size);
    }
  }
}

/* E7.12: parts that move as rigid bodies alone have, welded, no elastic mode, and that is no fault. */
TEST(rigid_parts_have_no_common_modes)
{
  const fb_weld weld = {{0, 1}, {2, 0}};
  for (int c = 0; c < 2; c++) {
    fb_modes_desc *keep;
    uniform_desc(2, FB_ROOT_FREE);
    desc.station[0].i_y = desc.station[0].i_z = FB_R(0.05);
    desc.position[0] = c ? desc.length : FB_R(0.0);
    keep = choice();
    keep->rigid = 1;
    FBT_INT_EQ(fb_modes_solve(&limb_basis[c], &work, &beam, keep), FB_OK);
    FBT_INT_EQ(limb_basis[c].n, 6);
    limb[c] = beam;
  }
  FBT_INT_EQ(fb_modes_join(common, &join_work, limb, limb_basis, 2, &weld, 1, 0, FB_R(0.0)), FB_OK);
  FBT_INT_EQ(common[0].n + common[1].n, 0);
}

/* Value of an axial function at x by its coefficients: cubic Hermite part and bubbles, of beams of one or two
   elements. */
static double function_value(const fb_modes *in, int k, double x)
{
  const int n_element = in->degree == 3 ? 2 : 1;
  const double l = 2.0 / n_element;
  const int e = x < l || n_element == 1 ? 0 : 1;
  const double s = x / l - e, b = 16.0 * s * s * (1.0 - s) * (1.0 - s), r = 2.0 * s - 1.0;
  const fb_real *c = in->shape + k * in->ndof, *bubble = c + 2 * (n_element + 1) + (in->degree - 3) * e;
  double value = (double)c[2 * e] * (1.0 + s * s * (2.0 * s - 3.0)) +
                 (double)c[2 * e + 1] * l * s * (1.0 - s) * (1.0 - s) + (double)c[2 * e + 2] * s * s * (3.0 - 2.0 * s) +
                 (double)c[2 * e + 3] * l * s * s * (s - 1.0);
  const double P[6] = {
      1.0, r, 1.5 * r * r - 0.5, (5.0 * r * r - 3.0) * r / 2.0, (35.0 * r * r * r * r - 30.0 * r * r + 3.0) / 8.0, 0.0};
  for (int j = 0; j + 3 < in->degree; j++) {
    value += (double)bubble[j] * b * P[j];
  }
  return value;
}

/* E6.7, E7.5: M = 1; in the plane whose stiffness orders them the functions are its bending modes (beta L of the
   clamped-free beam); at the ends of elements value and slope agree from both sides; only the root function has strain
   at the root, and with it u_x = x, the stretch of a pulled rod, is a combination of them. */
TEST(functions_are_orthonormal_and_as_smooth_as_they_claim)
{
  static const double beta_L[3] = {1.8751040687119611, 4.694091132974175, 7.854757438237613};
  for (int degree = 3; degree <= 8; degree += 5) {
    const int elements = degree == 3 ? 2 : 1, m = (degree - 1) * elements;
    static fb_modes_desc keep;
    double compliance = 0.0;
    memset(&keep, 0, sizeof keep);
    keep.basis = FB_BASIS_FUNCTIONS;
    keep.count[FB_KIND_BEND_Y] = degree == 3 ? m : 4;
    keep.count[FB_KIND_BEND_Z] = degree == 3 ? m : 0;
    keep.count[FB_KIND_AXIAL] = m;
    keep.degree = degree;
    keep.root_strain = 1;
    uniform_desc(elements, FB_ROOT_CLAMPED);
    FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, &keep), FB_OK);
    FBT_INT_EQ(modes.n, keep.count[0] + keep.count[1] + m + 1);
    for (int i = 0; i < modes.n; i++) {
      for (int j = 0; j < modes.n; j++) {
        FBT_NEAR_ABS(modes.M[i * modes.n + j], i == j, FBT_TOL(1e-12, degree == 3 ? 1e-5 : 1e-3));
      }
      FBT_TRUE((fabs((double)modes.shape[i * modes.ndof + 1]) > 0.01) == (i == modes.n - 1)); /* slope at the root */
    }
    for (int k = 0, i = 0; k < 3 && degree == 8; k++, i++) {
      double above;
      while (modes.kind[i] != FB_KIND_BEND_Y) {
        i++;
      }
      above = (double)modes.K[i * (modes.n + 1)] / (7.0 / 3.0 * pow(beta_L[k] / 2.0, 4.0)) - 1.0;
      FBT_BELOW(above, k == 2 ? 6e-4 : FBT_TOL(1e-7, 1e-4));
      FBT_TRUE(above > -FBT_TOL(1e-12, 1e-4)); /* Rayleigh-Ritz: from above */
    }
    /* Rayleigh-Ritz of a rod pulled at the tip is exact: q^T K q with q the projection of u = x is EA L */
    for (int i = 0; i < modes.n; i++) {
      for (int j = 0; j < modes.n; j++) {
        double moment[2];
        if (modes.kind[i] != FB_KIND_AXIAL || modes.kind[j] != FB_KIND_AXIAL) {
          continue;
        }
        for (int k = 0; k < 2; k++) { /* int u x mass dx by Simpson's rule */
          moment[k] = 0.0;
          for (int p = 0; p <= 4000; p++) {
            const double x = 2.0 * p / 4000.0, w = (p == 0 || p == 4000 ? 1.0 : p % 2 ? 4.0 : 2.0) * 2.0 / 12000.0;
            moment[k] += 3.0 * w * x * function_value(&modes, k ? j : i, x);
          }
        }
        compliance += moment[0] * (double)modes.K[i * modes.n + j] * moment[1];
      }
    }
    FBT_NEAR_REL(compliance, 11.0 * 2.0, FBT_TOL(1e-8, 1e-3));
  }
}

/* E7.5, E6.7: of a beam whose mass and stiffness change along its elements, at stations between their nodes, too,
   the functions are orthonormal against the mass, and those along y diagonal in its stiffness. */
TEST(functions_of_a_changing_beam_are_its_own)
{
  for (int degree = 3; degree <= 5; degree++) {
    const int m = 2 * (degree - 1);
    fb_modes_desc *keep;
    fbt_seed(1);
    coupled_desc(2, FB_ROOT_CLAMPED);
    desc.n_lump = 0;
    for (int k = 0; k < desc.n_station; k++) {
      desc.station[k].i_y = desc.station[k].i_z = FB_R(0.0);
    }
    keep = choice();
    keep->basis = FB_BASIS_FUNCTIONS;
    keep->degree = degree;
    keep->count[FB_KIND_BEND_Y] = keep->count[FB_KIND_AXIAL] = m;
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
    FBT_INT_EQ(modes.n, 2 * m);
    for (int ab = 0; ab < 4 * m * m; ab++) {
      const int a = ab / (2 * m), b = ab % (2 * m);
      const double size = sqrt((double)modes.K[a * (2 * m + 1)] * (double)modes.K[b * (2 * m + 1)]);
      FBT_NEAR_ABS(modes.M[ab], a == b, FBT_TOL(1e-11, 1e-3));
      if (a != b && modes.kind[a] == FB_KIND_BEND_Y && modes.kind[b] == FB_KIND_BEND_Y) {
        FBT_NEAR_ABS(modes.K[ab], 0.0, FBT_TOL(1e-10, 1e-2) * size);
      }
    }
  }
}

/* Integral of the product of two functions times the mass 3 - 0.8 x, of a beam of length 2, by Simpson's rule. */
static double function_product(const fb_modes *in, int i, int j)
{
  double sum = 0.0;
  for (int p = 0; p <= 2000; p++) {
    const double x = 2.0 * p / 2000.0, w = (p == 0 || p == 2000 ? 1.0 : p % 2 ? 4.0 : 2.0) * 2.0 / 6000.0;
    sum += w * (3.0 - 0.8 * x) * function_value(in, i, x) * function_value(in, j, x);
  }
  return sum;
}

/* E6.4, E7.5: the mass matrix of element functions is the integral of their products along the same direction, and by
   each lumped body its energy at the displacement and slope of its node. */
TEST(functions_carry_the_lumped_bodies)
{
  static fb_modes_desc keep;
  coupled_desc(2, FB_ROOT_CLAMPED);
  desc.n_station = 2;
  desc.station[0].i_y = desc.station[0].i_z = FB_R(0.0);
  desc.station[1] = desc.station[0];
  desc.station[1].x = FB_R(2.0);
  desc.station[0].mass = FB_R(3.0);
  desc.station[1].mass = FB_R(1.4);
  memset(&keep, 0, sizeof keep);
  keep.basis = FB_BASIS_FUNCTIONS;
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = keep.count[FB_KIND_AXIAL] = 3;
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, &keep), FB_OK);
  FBT_INT_EQ(modes.n, 9);
  for (int ab = 0; ab < 81; ab++) {
    const int mode[2] = {ab / 9, ab % 9};
    const int along = modes.kind[mode[0]] == modes.kind[mode[1]];
    double energy = along ? function_product(&modes, mode[0], mode[1]) : 0.0;
    for (int k = 0; k < 2; k++) {
      double y[2][6] = {{0.0}};
      for (int side = 0; side < 2; side++) { /* value and slope of the function at the node */
        const fb_real *const at = modes.shape + mode[side] * modes.ndof + 2 * desc.lump[k].node;
        const fb_kind kind = modes.kind[mode[side]];
        y[side][kind == FB_KIND_AXIAL ? 0 : kind == FB_KIND_BEND_Y ? 1 : 2] = (double)at[0];
        if (kind != FB_KIND_AXIAL) {
          y[side][kind == FB_KIND_BEND_Y ? 5 : 4] = (kind == FB_KIND_BEND_Y ? 1.0 : -1.0) * (double)at[1];
        }
      }
      for (int ij = 0; ij < 36; ij++) {
        energy += y[0][ij / 6] * lump_mass(&desc.lump[k], ij / 6, ij % 6) * y[1][ij % 6];
      }
    }
    FBT_NEAR_ABS(modes.M[ab], energy, FBT_TOL(1e-9, 1e-4));
  }
}

/* E7.5: of one direction alone the first functions are its lowest modes, those of its own stiffness (beta L = 1.8751 of
   the clamped-free beam, pi/2 of the rod), from above; those of the rod have no strain at the root. */
TEST(functions_of_one_direction_are_its_lowest_modes)
{
  static const double beta_L[3] = {1.8751040687119611, 1.8751040687119611, 1.5707963267948966};
  static const fb_kind kind[3] = {FB_KIND_BEND_Y, FB_KIND_BEND_Z, FB_KIND_AXIAL};
  for (int d = 0; d < 3; d++) {
    static fb_modes_desc keep;
    const double stiffness[3] = {7.0, 5.0, 11.0}; /* EI_z, EI_y, EA */
    memset(&keep, 0, sizeof keep);
    keep.basis = FB_BASIS_FUNCTIONS;
    keep.count[kind[d]] = 1;
    uniform_desc(3, FB_ROOT_CLAMPED);
    desc.station[0].EI_z = d == 0 ? FB_R(7.0) : FB_R(0.0);
    desc.station[0].EI_y = d == 1 ? FB_R(5.0) : FB_R(0.0);
    desc.station[0].EA = d == 2 ? FB_R(11.0) : FB_R(0.0);
    FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, &keep), FB_OK);
    FBT_INT_EQ(modes.n, 1);
    for (int i = 0; i < 6; i++) {
      FBT_NEAR_ABS(modes.effective[i], 0.0, 0.0); /* not told of functions */
    }
    FBT_NEAR_REL(modes.K[0], stiffness[d] / 3.0 * pow(beta_L[d] / 2.0, d < 2 ? 4.0 : 2.0), d < 2 ? 3e-4 : 0.1);
  }
}

SUITE(modes, RUN(hurty_example_has_the_printed_numbers),
      RUN(boundaries_that_move_a_free_component_have_no_negative_stiffness),
      RUN(components_deflect_exactly_at_their_boundary), RUN(static_corrections_make_loads_exact),
      RUN(the_lowest_modes_are_the_lowest_of_all_kinds), RUN(effective_masses_add_up_to_the_beam),
      RUN(components_keep_their_rigid_motions), RUN(columns_buckle_under_the_published_loads),
      RUN(preload_changes_the_frequencies_as_in_a_stiff_string), RUN(timoshenko_beams_have_the_published_frequencies),
      RUN(functions_are_orthonormal_and_as_smooth_as_they_claim), RUN(functions_of_one_direction_are_its_lowest_modes),
      RUN(functions_carry_the_lumped_bodies), RUN(one_mode_and_its_correction_are_as_good_as_all),
      RUN(the_lowest_modes_below_a_limit_are_all_below_it),
      RUN(components_with_shear_deflect_exactly_in_every_direction), RUN(beam_frequencies_match_the_closed_form),
      RUN(frequencies_converge_with_order_eight_and_six), RUN(element_coordinates_converge_with_order_four_and_two),
      RUN(tip_mass_lowers_the_frequencies_as_published), RUN(rotary_inertia_lowers_the_frequencies_as_rayleigh_found),
      RUN(tapered_beam_has_the_published_frequencies), RUN(modes_are_orthonormal_with_a_fixed_sign),
      RUN(a_held_tip_does_not_choose_the_sign), RUN(a_round_beam_has_pairs_of_unmixed_modes),
      RUN(a_body_beside_the_axis_couples_bending_and_torsion), RUN(a_beam_without_mass_has_the_modes_of_its_tip_body),
      RUN(frequencies_do_not_depend_on_the_units), RUN(modes_may_fill_all_their_room),
      RUN(a_part_alone_keeps_its_modes), RUN(functions_of_a_changing_beam_are_its_own),
      RUN(a_component_of_all_nodes_has_the_stiffness_of_the_elements), RUN(preloads_add_up_to_the_tension),
      RUN(columns_buckle_below_the_body_that_they_carry), RUN(free_beams_keep_the_digits_of_their_low_modes),
      RUN(a_free_chain_has_the_inertia_of_its_rods), RUN(welded_limbs_are_the_chain_of_their_elements),
      RUN(rigid_parts_have_no_common_modes), RUN(momenta_and_effective_masses_are_those_of_the_whole_beam),
      RUN(bodies_couple_the_kinds_that_they_should), RUN(modes_are_selected_by_count_and_frequency),
      RUN(element_coordinates_keep_the_element_matrices), RUN(modes_for_a_spin_hold_the_modes_under_tension),
      RUN(modes_that_do_not_exist_are_refused))
