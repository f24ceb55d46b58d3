/* >>modes: frequencies, buckling and tension against closed forms and published figures. */
#include "modes.h"

#define ROUNDING FBT_TOL(1e-11, 1e-4)
static fb_modes modes, other;

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
    for (int i = 0; i < keep->n_boundary; i++) {
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
      FBT_INT_EQ(fb_buckling_solve(&modes, &work, &beam, keep), FB_ERR_MODES);
      desc.station[0].tension_y = FB_R(0.02);
      desc.station[0].twist = FB_R(0.3);
      FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
      FBT_INT_EQ(fb_buckling_solve(&modes, &work, &beam, keep), FB_ERR_MODES);
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
  FBT_INT_EQ(solve(&other, 2, 0, 0, 0), FB_ERR_MODES);
  FBT_INT_EQ(solve(&other, 0, 0, 2, 0), FB_ERR_MODES);
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
    fb_coordinate *const at = component ? &keep->boundary[k] : &keep->load[k];
    at->node = 2;
    at->axis = axis[k];
  }
  return fb_modes_solve(out, &work, &beam, keep);
}

/* >>modes, E7.8, E7.9: a beam in other units of length, mass and time, powers of two, has the same frequencies,
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
      if (run >= 3) {
        desc.n_lump = 0;
        memset(desc.lump, 0, sizeof desc.lump);
      }
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

/* E7.1: a beam flexible in torsion without polar inertia, its hub a lump at the free root: torsion has no modes, and
   bending those of the same beam that is rigid in torsion. */
TEST(torsion_without_polar_inertia_leaves_the_rest)
{
  static fb_modes stiff;
  for (int soft = 0; soft < 2; soft++) {
    uniform_desc(4, FB_ROOT_FREE);
    desc.station[0].GJ = soft ? FB_R(13.0) : FB_R(0.0);
    desc.n_lump = 1;
    desc.lump[0].mass = FB_R(6.0);
    desc.lump[0].inertia[0] = desc.lump[0].inertia[1] = desc.lump[0].inertia[2] = FB_R(2.0);
    FBT_INT_EQ(solve(soft ? &modes : &stiff, 3, 2, 1, 0), FB_OK);
  }
  FBT_INT_EQ(modes.n, 6);
  for (int k = 0; k < 6; k++) {
    FBT_NEAR_REL(modes.omega[k], stiff.omega[k], FBT_TOL(1e-12, 1e-5));
  }
  FBT_INT_EQ(solve(&modes, 3, 2, 1, 1), FB_ERR_KIND);
}

SUITE(modes_frequencies, RUN(torsion_without_polar_inertia_leaves_the_rest),
      RUN(columns_buckle_under_the_published_loads), RUN(preload_changes_the_frequencies_as_in_a_stiff_string),
      RUN_LONG(timoshenko_beams_have_the_published_frequencies), RUN(beam_frequencies_match_the_closed_form),
      RUN(frequencies_converge_with_order_eight_and_six), RUN(element_coordinates_converge_with_order_four_and_two),
      RUN(tip_mass_lowers_the_frequencies_as_published), RUN(rotary_inertia_lowers_the_frequencies_as_rayleigh_found),
      RUN(tapered_beam_has_the_published_frequencies), RUN(a_body_beside_the_axis_couples_bending_and_torsion),
      RUN(a_beam_without_mass_has_the_modes_of_its_tip_body), RUN(frequencies_do_not_depend_on_the_units),
      RUN(preloads_add_up_to_the_tension), RUN(columns_buckle_below_the_body_that_they_carry),
      RUN(free_beams_keep_the_digits_of_their_low_modes), RUN_LONG(modes_for_a_spin_hold_the_modes_under_tension))
