/* Section 12: steady states, linearization, complex modes: against characteristic polynomials in closed form, statics,
   the modes they are made of, and published frequencies of a rotor blade. */
#include "fbt.h"

#define EPS FBT_TOL(2.2204460492503131e-16, 1.19209290e-7)
static const double pi = 3.14159265358979323846;

static fb_shape shape;
static fb_body body;
static fb_body_work body_work;
static fb_analyse_work work;
static fb_spectrum spectrum;

/* A particle of 1 kg at (R, 0, 0) on springs k_x, k_y with dashpots, in a frame that turns about z. */
static void particle_on_springs(double R, double kx, double ky, double zeta)
{
  static fb_body_desc desc;
  const fb_real r[3] = {(fb_real)R, FB_R(0.0), FB_R(0.0)}, psi[6] = {FB_R(1.0), 0, 0, 0, FB_R(1.0), 0};
  memset(&desc, 0, sizeof desc);
  FBT_INT_EQ(fb_shape_init(&shape, 2), FB_OK);
  FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(1.0), r, psi, NULL), FB_OK);
  shape.K[0] = (fb_real)kx;
  shape.K[3] = (fb_real)ky;
  desc.effects = FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA | FB_EFFECT_DAMPING;
  desc.base = FB_BASE_PRESCRIBED;
  desc.zeta[0] = desc.zeta[1] = (fb_real)zeta;
  desc.deflection_limit = FB_R(10.0);
  desc.allow_split_effects = 1; /* a particle has no foreshortening */
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
}

/* E12.1 to E12.3: u_x'' + c_x u_x' - 2 w u_y' + (k_x - w^2) u_x = w^2 R, u_y'' + c_y u_y' + 2 w u_x' + (k_y - w^2) u_y
   = 0 (the dashpots turn with the frame): the particle rests at w^2 R/(k_x - w^2), and the eigenvalues are the roots of
   (l^2 + c_x l + k_x - w^2)(l^2 + c_y l + k_y - w^2) + 4 w^2 l^2, which also gives their number; beyond w^2 = k_x one
   root is positive. */
TEST(spectrum_of_a_spinning_oscillator_is_closed_form)
{
  for (int run = 0; run < 8; run++) {
    const double w = 0.5 * run, kx = 4.0, ky = 9.0, zeta = run % 2 ? 0.05 : 0.0;
    const double cx = 2.0 * zeta * 2.0, cy = 2.0 * zeta * 3.0, a = kx - w * w, b = ky - w * w;
    fb_state state;
    fb_input input;
    double sum = 0.0, unstable = 0.0;
    if (run == 4 || run == 6) {
      continue; /* a or b vanish: no steady state */
    }
    particle_on_springs(0.5, kx, ky, zeta);
    memset(&input, 0, sizeof input);
    input.w[2] = (fb_real)w;
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_OK);
    FBT_NEAR_ABS(state.q[0], w * w * 0.5 / a, FBT_TOL(1e-12, 1e-4));
    FBT_NEAR_ABS(state.q[1], 0.0, FBT_TOL(1e-12, 1e-4));
    FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &body, &state, &input), FB_OK);
    for (int k = 0; k < spectrum.n; k++) {
      const double x = (double)spectrum.re[k], y = (double)spectrum.im[k];
      const double s = x * x - y * y, t = 2.0 * x * y; /* l^2 */
      const double p = s + cx * x + a, q = t + cx * y, u = s + cy * x + b, v = t + cy * y;
      FBT_NEAR_ABS(p * u - q * v + 4.0 * w * w * s, 0.0, FBT_TOL(2e-9, 0.2));
      FBT_NEAR_ABS(p * v + q * u + 4.0 * w * w * t, 0.0, FBT_TOL(2e-9, 0.2));
      sum += x * (y > 0.0 ? 2.0 : 1.0);
      unstable = fmax(unstable, x);
      FBT_NEAR_ABS(fb_spectrum_damping(&spectrum, k), -x / sqrt(x * x + y * y), 8.0 * EPS);
    }
    FBT_NEAR_ABS(sum, -cx - cy, FBT_TOL(1e-11, 1e-3)); /* all four are there: the trace */
    FBT_TRUE((unstable > 0.1) == (w > 2.0 && w < 3.0));
  }
}

/* E12.3, E8.7: at rest the complex modes are the modes, with their damping ratios, frequencies and shapes. */
TEST(damped_modes_have_their_ratios)
{
  static fb_beam_desc desc;
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_modes_desc keep;
  static fb_body_desc level;
  fb_state state;
  fb_input input;
  desc.length = FB_R(2.0);
  desc.n_element = 4;
  desc.n_station = 1;
  desc.station[0].mass = FB_R(3.0);
  desc.station[0].EI_y = FB_R(50.0);
  desc.station[0].EI_z = FB_R(70.0);
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 3;
  level.effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING | FB_EFFECT_GRAVITY;
  level.base = FB_BASE_PRESCRIBED;
  level.gravity[1] = -FB_R(0.1);
  for (int k = 0; k < 6; k++) {
    level.zeta[k] = FB_R(0.01) * (fb_real)(k + 1);
  }
  memset(&input, 0, sizeof input);
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &body, &state, &input), FB_OK);
  FBT_INT_EQ(spectrum.n, 6);
  for (int k = 0; k < 6; k++) {
    const double re = (double)spectrum.re[k], im = (double)spectrum.im[k];
    double own = 0.0, other = 0.0;
    FBT_NEAR_REL(sqrt(re * re + im * im), modes.omega[k], FBT_TOL(1e-10, 1e-4));
    FBT_NEAR_ABS(fb_spectrum_damping(&spectrum, k), 0.01 * (k + 1), FBT_TOL(1e-11, 1e-4));
    for (int a = 0; a < 6; a++) {
      const double size = hypot((double)spectrum.shape_re[6 * k + a], (double)spectrum.shape_im[6 * k + a]);
      own += a == k ? size : 0.0;
      other += a == k ? 0.0 : size;
    }
    FBT_BELOW(other / own, FBT_TOL(1e-9, 1e-2));
  }
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input),
             FB_OK); /* sag m g L^3/8EI, of which three modes hold nearly all */
  {
    double tip = 0.0;
    for (int a = 0; a < 6; a++) {
      tip += (double)state.q[a] * (double)modes.shape[a * modes.ndof + 6 * 4 + 1];
    }
    FBT_NEAR_REL(tip, -0.1 * 3.0 * 16.0 / (8.0 * 70.0), 1e-3);
  }
}

/* E6.12, E7.2, E12.3: the blade of the NREL 5-MW turbine (nrel5mw_blade.csv, NREL/TP-500-38060; 49 stations, twisted):
   mass, first and second moment, and the clamped frequencies at rest and at 12.1 rpm against ElastoDyn's, which come
   from polynomials of one direction each and so lie somewhat higher. */
TEST(nrel_blade_has_the_published_figures)
{
  static const double figure[2][3] = {{0.682966, 1.096501, 1.986600},
                                      {0.734079, 1.122939, 2.043999}}; /* flap edge flap */
  static const double factor = 1.04536, length = 61.5;                 /* AdjBlMs */
  static fb_beam_desc desc;
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_modes_desc keep;
  static fb_body_desc level;
  const fbt_table *table = fbt_reference("nrel5mw_blade.csv");
  double sum[3] = {0.0, 0.0, 0.0}, largest = 0.0;
  FBT_INT_EQ(table->rows, 49);
  desc.length = (fb_real)length;
  desc.n_element = 10;
  desc.n_station = table->rows;
  desc.position[0] = FB_R(1.5);
  for (int k = 0; k < table->rows; k++) {
    fb_section *s = &desc.station[k];
    s->x = (fb_real)(fbt_value(table, k, "span_fraction") * length);
    s->twist = (fb_real)(fbt_value(table, k, "twist_deg") * pi / 180.0);
    s->mass = (fb_real)(fbt_value(table, k, "mass") * factor);
    s->EI_y = (fb_real)fbt_value(table, k, "EI_flap");
    s->EI_z = (fb_real)fbt_value(table, k, "EI_edge");
    s->GJ = (fb_real)fbt_value(table, k, "GJ");
    s->EA = (fb_real)fbt_value(table, k, "EA");
  }
  for (int node = 0; node < 17; node++) { /* ElastoDyn's own sums, 17 nodes in the middles of equal pieces */
    const double x = (node + 0.5) / 17.0 * length;
    fb_section s;
    beam.desc = desc;
    fb_beam_section(&s, &beam, (fb_real)x);
    for (int power = 0; power < 3; power++) {
      sum[power] += (double)s.mass * pow(x, power) * length / 17.0;
    }
  }
  FBT_NEAR_REL(sum[0], 17536.614, 1e-6);
  FBT_NEAR_REL(sum[1], 362132.653, 1e-6);
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 4;
  keep.count[FB_KIND_AXIAL] = 1;
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_NEAR_REL(beam.mass, 16844.752 * factor, FBT_TOL(1e-6, 1e-5));
  FBT_NEAR_REL(modes.rigid_mass[0], 16844.752 * factor, FBT_TOL(1e-6, 1e-5));
  FBT_NEAR_REL(modes.rigid_mass[4], 1.11816e7 * factor, 1e-3); /* trapezoids lie 6e-4 lower */
  level.effects = FB_EFFECTS_FULL;
  level.base = FB_BASE_PRESCRIBED;
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_NEAR_REL(shape.c[0] / shape.mass - FB_R(1.5), 20.5073, 1e-3);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
  for (int run = 0; run < 2; run++) {
    fb_state state;
    fb_input input;
    memset(&input, 0, sizeof input);
    input.w[2] = (fb_real)(run * 12.1 * 2.0 * pi / 60.0);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_OK);
    FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &body, &state, &input), FB_OK);
    for (int k = 0; k < 3; k++) {
      const double ratio = (double)spectrum.im[k] / (2.0 * pi) / figure[run][k] - 1.0;
      largest = fmax(largest, fabs(ratio));
      FBT_BELOW(ratio, 0.0);
      FBT_BELOW(-0.03, ratio);
    }
  }
  fbt_figure("NREL 5-MW blade, flap, edge, flap at 0 and 12.1 rpm", "ElastoDyn", largest);
}

/* Section 12: what cannot be linearized is refused, the state kept. */
TEST(analysis_refuses_bad_input)
{
  static fb_real A[16];
  fb_state state, kept;
  fb_input input;
  particle_on_springs(0.5, 4.0, 9.0, 0.0);
  memset(&input, 0, sizeof input);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  kept = state;
  FBT_INT_EQ(fb_body_trim(NULL, &state, &work, &input), FB_ERR_NULL);
  FBT_INT_EQ(fb_body_trim(&body, NULL, &work, &input), FB_ERR_NULL);
  FBT_INT_EQ(fb_body_trim(&body, &state, NULL, &input), FB_ERR_NULL);
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, NULL), FB_ERR_NULL);
  FBT_INT_EQ(fb_body_linearize(NULL, &work, &body, &state, &input), FB_ERR_NULL);
  FBT_INT_EQ(fb_body_linearize(A, NULL, &body, &state, &input), FB_ERR_NULL);
  input.n_load = 1;
  input.load[0].node = 99;
  A[0] = FB_R(7.0);
  FBT_INT_EQ(fb_body_linearize(A, &work, &body, &state, &input), FB_ERR_CAPACITY);
  FBT_NEAR_ABS(A[0], 7.0, 0.0);
  input.n_load = 0;
  FBT_INT_EQ(fb_body_spectrum(NULL, &work, &body, &state, &input), FB_ERR_NULL);
  FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &body, NULL, &input), FB_ERR_NULL);
  input.w[2] = (fb_real)NAN;
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_NOT_FINITE);
  input.w[2] = FB_R(1.99); /* rests 49.6 m out: beyond the limit of 10 m */
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_RANGE);
  FBT_TRUE(memcmp(&state, &kept, sizeof state) == 0);
  state.q[0] = (fb_real)NAN;
  FBT_INT_EQ(fb_body_spectrum(&spectrum, &work, &body, &state, &input), FB_ERR_NOT_FINITE);
  state.q[0] = FB_R(0.0);
  body.base = FB_BASE_FREE;
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_VALUE);
  FBT_INT_EQ(fb_body_linearize(A, &work, &body, &state, &input), FB_ERR_VALUE);
}

SUITE(analyse, RUN(spectrum_of_a_spinning_oscillator_is_closed_form), RUN(damped_modes_have_their_ratios),
      RUN(nrel_blade_has_the_published_figures), RUN(analysis_refuses_bad_input))
