/* >>assemble: finite-element models with the effects of second degree: from geometric stiffness by inertia loads, and
   along lines from mode shapes alone. */
#include "body.h"

/* ---- geometric stiffness */

/* Geometric stiffness of the pair a, b of particles under the inertia load of a frame that accelerates by A, turns
   faster by turn and spins with w: minus the work of the loads on chi_ab. */
static double load_work(const particles *p, int a, int b, const double A[3], const double turn[3], const double w[3])
{
  double K = 0.0;
  for (int i = 0; i < PARTICLES; i++) {
    double euler[3], whirl[3], centripetal[3];
    cross(euler, turn, p->r[i]);
    cross(whirl, w, p->r[i]);
    cross(centripetal, w, whirl);
    for (int k = 0; k < 3; k++) {
      K += p->m[i] * (A[k] + euler[k] + centripetal[k]) * p->chi[i][a][b][k];
    }
  }
  return K;
}

/* Twelve geometric stiffness numbers of a pair, as a program that knows loads alone finds them. */
static void pair_stiffening(fb_real by[3][6], const particles *p, int a, int b)
{
  const double none[3] = {0.0};
  for (int k = 0; k < 3; k++) {
    double unit[3] = {0.0}, pair[3] = {1.0, 1.0, 1.0};
    unit[k] = 1.0;
    pair[2 - k] = 0.0; /* xy, xz, yz */
    by[0][k] = (fb_real)load_work(p, a, b, unit, none, none);
    by[1][k] = (fb_real)load_work(p, a, b, none, unit, none);
    by[2][k] = (fb_real)load_work(p, a, b, none, none, unit);
    by[2][3 + k] = (fb_real)load_work(p, a, b, none, none, pair);
  }
  for (int k = 0; k < 3; k++) { /* less the squares */
    by[2][3 + k] -= by[2][k == 2 ? 1 : 0] + by[2][k == 0 ? 1 : 2];
  }
}

/* E8.51 against E8.1 of particles: their loads do work on chi. */
TEST(geometric_stiffness_gives_the_integrals_of_the_quadratic_field)
{
  static particles plain;
  static fb_shape whole, made;
  const int n = 4;
  double worst = 0.0;
  particles_random(&cloud, n, 1);
  plain = cloud;
  memset(plain.chi, 0, sizeof plain.chi);
  particles_to_shape(&whole, &cloud);
  particles_to_shape(&made, &plain);
  for (int a = 0; a < n; a++) {
    for (int b = 0; b <= a; b++) {
      fb_real by[3][6];
      pair_stiffening(by, &cloud, a, b);
      FBT_INT_EQ(fb_shape_add_stiffening(&made, a, b, by[0], by[1], by[2]), FB_OK);
    }
  }
  worst = fmax(worst, fbt_difference(made.second.pchi, whole.second.pchi, 3 * n * n));
  worst = fmax(worst, fbt_difference(made.second.hchi, whole.second.hchi, 3 * n * n));
  worst = fmax(worst, fbt_difference(made.second.Gamchi, whole.second.Gamchi, 9 * n * n));
  fbt_figure("integrals of the quadratic field from geometric stiffness", "those of particles", worst);
  FBT_BELOW(worst, FBT_TOL(1e-13, 1e-4));
  { /* bad input leaves the shape as it is */
    static fb_shape kept;
    const fb_real good[6] = {0}, bad[6] = {0, 0, (fb_real)NAN, 0, 0, 0};
    memcpy(&kept, &made, sizeof made);
    FBT_INT_EQ(fb_shape_add_stiffening(&made, 0, n, good, good, good), FB_ERR_CAPACITY);
    FBT_INT_EQ(fb_shape_add_stiffening(&made, 0, -1, good, good, good), FB_ERR_CAPACITY);
    FBT_INT_EQ(fb_shape_add_stiffening(&made, 0, 1, bad, good, good), FB_ERR_NOT_FINITE);
    FBT_INT_EQ(fb_shape_add_stiffening(&made, 0, 1, good, good, bad), FB_ERR_NOT_FINITE);
    FBT_INT_EQ(fb_shape_add_stiffening(&made, 0, 1, good, NULL, good), FB_ERR_NULL);
    FBT_TRUE(memcmp(&kept, &made, sizeof made) == 0);
  }
}

/* ---- a uniform cantilever along x from the hub radius on: length and mass 1, EI 1, modes (x/L)^(a + 2) out of the plane
   of spin; the axial force of an inertia load is what its mass outboard weighs */

#define SHAPES (FB_SINGLE ? 3 : 5) /* monomials are nearly alike */
#define SLICES 400

/* Geometric stiffness int N w_a' w_b' dx of the textbooks: N at x by a spin about z. */
static double axial_stiffness(int a, int b, double hub)
{
  const double sum = a + b + 2.0;                                         /* w_a' w_b' = (a + 2)(b + 2) x^(a + b + 2) */
  const double by_hub = hub * (1.0 / (sum + 1.0) - 1.0 / (sum + 2.0));    /* hub (1 - x) */
  const double by_length = 0.5 * (1.0 / (sum + 1.0) - 1.0 / (sum + 3.0)); /* (1 - x^2)/2 */
  return (a + 2.0) * (b + 2.0) * (by_hub + by_length);
}

/* The cantilever as lumped masses; along its line where `line`. */
static void cantilever(fb_shape *to, double hub, int line)
{
  static fb_fields at, before;
  const fb_real root[3] = {(fb_real)hub, 0, 0}, none[3 * SHAPES] = {0};
  FBT_INT_EQ(fb_shape_init(to, SHAPES), FB_OK);
  FBT_INT_EQ(fb_fields_init(&before, to, NULL, root, none, none), FB_OK);
  for (int k = 0; k < SLICES; k++) {
    const double x = (k + 0.5) / SLICES, mass = 1.0 / SLICES;
    const fb_real r[3] = {(fb_real)(hub + x), 0, 0};
    fb_real psi[3 * SHAPES] = {0}, theta[3 * SHAPES] = {0};
    for (int a = 0; a < SHAPES; a++) {
      psi[3 * a + 2] = (fb_real)pow(x, a + 2.0);
      theta[3 * a + 1] = (fb_real)(-(a + 2) * pow(x, a + 1.0));
    }
    if (line) {
      FBT_INT_EQ(fb_fields_init(&at, to, &before, r, psi, theta), FB_OK);
      FBT_INT_EQ(fb_shape_add_field_lump(to, &at, (fb_real)mass, NULL), FB_OK);
      before = at;
    } else {
      FBT_INT_EQ(fb_shape_add_lump(to, (fb_real)mass, r, NULL, psi, theta), FB_OK);
    }
  }
  for (int a = 0; a < SHAPES; a++) { /* int w_a'' w_b'' dx */
    for (int b = 0; b < SHAPES; b++) {
      to->K[a * SHAPES + b] = (fb_real)((a + 2.0) * (a + 1.0) * (b + 2.0) * (b + 1.0) / (a + b + 1.0));
    }
  }
}

/* First flap frequency of the shape at a spin. */
static double flap(const fb_shape *from, double spin)
{
  static fb_analyse_work work;
  static fb_spectrum spectrum;
  fb_body_desc desc;
  fb_state state;
  fb_input input;
  memset(&desc, 0, sizeof desc);
  memset(&input, 0, sizeof input);
  desc.effects = FB_EFFECTS_FULL;
  desc.base = FB_BASE_PRESCRIBED;
  input.w[2] = (fb_real)spin;
  FBT_INT_EQ(fb_body_init(&body, &body_work, from, &desc), FB_OK);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_OK);
  FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, &spectrum, &state, &input), FB_OK);
  return (double)spectrum.im[0];
}

/* E8.50 and E8.51: an imported cantilever at a spin has the frequencies of the rotating cantilever (tests/reference/p02),
   by the textbook's geometric stiffness and along its line. */
TEST(imported_cantilevers_stiffen_as_published)
{
  static fb_shape made;
  static const double hubs[] = {0.0, 1.0};
  const fbt_table *table = fbt_reference("p02_rotating_uniform.csv");
  double worst[2] = {0.0, 0.0};
  for (int h = 0; h < FBT_COUNT(hubs); h++) {
    for (int line = 0; line < 2; line++) {
      cantilever(&made, hubs[h], line);
      for (int ab = 0; ab < SHAPES * SHAPES && !line; ab++) {
        const fb_real none[6] = {0};
        fb_real spin[6] = {0};
        spin[2] = (fb_real)axial_stiffness(ab / SHAPES, ab % SHAPES, hubs[h]);
        if (ab / SHAPES >= ab % SHAPES) {
          FBT_INT_EQ(fb_shape_add_stiffening(&made, ab / SHAPES, ab % SHAPES, none, none, spin), FB_OK);
        }
      }
      for (int row = 0; row < table->rows; row++) {
        if (fbt_value(table, row, "alpha") == hubs[h] && fbt_value(table, row, "mode") == 1.0 &&
            fbt_value(table, row, "eta") <= 3.0) {
          worst[line] = fmax(worst[line],
                             fabs(flap(&made, fbt_value(table, row, "eta")) / fbt_value(table, row, "mu_flap") - 1.0));
        }
      }
    }
  }
  fbt_figure("imported cantilever at a spin, geometric stiffness of the textbooks", "power series (p02)", worst[0]);
  fbt_figure("the same along its line, from mode shapes", "power series (p02)", worst[1]);
  FBT_BELOW(worst[0], FBT_TOL(1e-5, 2e-3));
  FBT_BELOW(worst[1], FBT_TOL(1e-5, 2e-3));
}

/* ---- lines */

/* E8.50 against E8.2 of the beam that the nodes are of: a line with a bend, both planes and torsion, out of the axes. */
TEST(imported_lines_have_the_fields_of_their_beam)
{
  static fb_shape whole;
  static fb_fields at, before;
  static const fb_real point[6][3] = {{0, 0, 0},  {1, 0, 0}, {2, FB_R(0.2), 0}, {3, FB_R(0.2), FB_R(-0.4)},
                                      {4, 0, -1}, {5, 0, -1}};
  const int elements = FBT_COUNT(point) - 1;
  fb_modes_desc keep;
  fb_real none[3 * FB_MAX_MODES] = {0};
  double worst = 0.0, size = 0.0;
  memset(&beam_desc, 0, sizeof beam_desc);
  memset(&keep, 0, sizeof keep);
  memcpy(beam_desc.point, point, sizeof point);
  beam_desc.n_point = elements + 1;
  beam_desc.n_element = elements;
  for (int k = 0; k < elements; k++) {
    double square = 0.0;
    for (int i = 0; i < 3; i++) {
      square += pow((double)(point[k + 1][i] - point[k][i]), 2.0);
    }
    beam_desc.length += (fb_real)sqrt(square);
  }
  beam_desc.position[1] = FB_R(0.3);
  beam_desc.attitude[0] = FB_R(0.8);
  beam_desc.attitude[2] = FB_R(0.6);
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = FB_R(1.3);
  beam_desc.station[0].EA = FB_R(1e5);
  beam_desc.station[0].EI_y = FB_R(50.0);
  beam_desc.station[0].EI_z = FB_R(80.0);
  beam_desc.station[0].GJ = FB_R(40.0);
  beam_desc.station[0].i_y = beam_desc.station[0].i_z = FB_R(0.01);
  keep.lowest = 6;
  keep.cubic = 1; /* fields between the nodes as E6.1 has them */
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&whole, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&whole, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_fields_init(&before, &shape, NULL, beam_desc.position, none, none), FB_OK);
  for (int k = 1; k <= elements; k++) {
    const fb_node *want = &whole.node[1], *got = &shape.node[1];
    int node;
    whole.n_node = shape.n_node = 1;
    FBT_INT_EQ(fb_shape_add_beam_node(&whole, &node, 0, &beam, &modes, beam.start[k]), FB_OK);
    FBT_INT_EQ(fb_fields_init(&at, &shape, &before, want->r, want->psi, want->theta), FB_OK);
    FBT_INT_EQ(fb_shape_add_field_node(&shape, &node, &at), FB_OK);
    FBT_TRUE(memcmp(got->psi, want->psi, sizeof want->psi) == 0);
    worst = fmax(worst, fbt_difference(got->chi, want->chi, 3 * modes.n * (modes.n + 1) / 2));
    worst = fmax(worst, fbt_difference(got->chi_theta, want->chi_theta, 3 * modes.n * (modes.n + 1) / 2));
    size = fmax(size, fbt_largest(want->chi, 3 * modes.n * (modes.n + 1) / 2));
    before = at;
  }
  fbt_figure("quadratic fields of a line of nodes, bends and torsion", "those of the beam they are of", worst / size);
  FBT_BELOW(worst, FBT_TOL(1e-12, 1e-4) * size);
}

/* E8.50 without rotations: two bars, modes are how far each one's end goes aside, along y or z exact; by Pythagoras x falls
   short by y^2/(2 L) of each. */
TEST(imported_chains_of_bars_keep_their_length)
{
  static fb_shape chain;
  static fb_fields origin, first, second;
  const fb_real root[3] = {0}, none[6] = {0}, a[3] = {2, 0, 0}, b[3] = {5, 0, 0};
  fb_real at_a[6], at_b[6];
  for (int side = 2; side > 0; side--) {
    memset(at_a, 0, sizeof at_a);
    memset(at_b, 0, sizeof at_b);
    at_a[side] = at_b[side] = at_b[3 + side] = FB_R(1.0);
    FBT_INT_EQ(fb_shape_init(&chain, 2), FB_OK);
    FBT_INT_EQ(fb_fields_init(&origin, &chain, NULL, root, none, NULL), FB_OK);
    FBT_INT_EQ(fb_fields_init(&first, &chain, &origin, a, at_a, NULL), FB_OK);
    FBT_INT_EQ(fb_fields_init(&second, &chain, &first, b, at_b, NULL), FB_OK);
    FBT_NEAR_REL(first.chi[0], -1.0 / 2.0, FBT_TOL(1e-14, 1e-6));
    FBT_NEAR_REL(second.chi[0], -1.0 / 2.0, FBT_TOL(1e-14, 1e-6));
    FBT_NEAR_REL(second.chi[3 * 3], -1.0 / 3.0, FBT_TOL(1e-14, 1e-6));
    for (int k = 0; k < 3; k++) { /* nothing else */
      FBT_NEAR_ABS(first.chi[9 + k], 0.0, FBT_TOL(1e-15, 1e-7));
      FBT_NEAR_ABS(second.chi[3 + k], 0.0, FBT_TOL(1e-15, 1e-7));
      FBT_NEAR_ABS(second.chi[6 + k], 0.0, FBT_TOL(1e-15, 1e-7));
      FBT_NEAR_ABS(k == 0 ? FB_R(0.0) : second.chi[k], 0.0, FBT_TOL(1e-15, 1e-7));
    }
  }
  { /* bad input leaves the fields as they are */
    static fb_fields kept;
    const fb_real bad[6] = {0, 0, (fb_real)INFINITY, 0, 0, 0};
    int node;
    kept = second;
    FBT_INT_EQ(fb_fields_init(&second, &chain, &first, a, at_b, NULL), FB_ERR_VALUE); /* where it already is */
    FBT_INT_EQ(fb_fields_init(&second, &chain, &first, b, bad, NULL), FB_ERR_NOT_FINITE);
    FBT_INT_EQ(fb_fields_init(&second, &chain, &first, b, at_b, bad), FB_ERR_NOT_FINITE);
    FBT_INT_EQ(fb_fields_init(&second, &chain, &first, b, NULL, NULL), FB_ERR_NULL);
    FBT_INT_EQ(fb_fields_init(&second, NULL, &first, b, at_b, NULL), FB_ERR_NULL);
    FBT_TRUE(memcmp(&kept, &second, sizeof kept) == 0);
    FBT_INT_EQ(fb_shape_add_field_lump(&chain, &second, -FB_R(1.0), NULL), FB_ERR_VALUE);
    FBT_INT_EQ(fb_shape_add_field_lump(&chain, NULL, FB_R(1.0), NULL), FB_ERR_NULL);
    for (int k = 1; k < FB_MAX_NODES; k++) {
      FBT_INT_EQ(fb_shape_add_field_node(&chain, &node, &second), FB_OK);
    }
    FBT_INT_EQ(fb_shape_add_field_node(&chain, &node, &second), FB_ERR_CAPACITY);
    FBT_TRUE(chain.mass == FB_R(0.0));
  }
  FBT_INT_EQ(fb_fields_init(&first, &chain, &first, b, at_b, NULL), FB_OK); /* in place */
  FBT_NEAR_REL(first.chi[3 * 3], -1.0 / 3.0, FBT_TOL(1e-14, 1e-6));
}

SUITE(body_imports, RUN(geometric_stiffness_gives_the_integrals_of_the_quadratic_field),
      RUN(imported_cantilevers_stiffen_as_published), RUN(imported_lines_have_the_fields_of_their_beam),
      RUN(imported_chains_of_bars_keep_their_length))
