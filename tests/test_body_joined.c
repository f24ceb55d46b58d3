/* >>body and >>assemble: bodies whose components were joined, and finite-element models, are the beams they came
   from. */
#include "body.h"

/* ---- as many coordinates, nodes and loads as there can be */

static fb_real half_unit = FB_R(1.0); /* [kg] of halves */
static double half_turn;              /* [rad] of the outer one about the line */

/* The boom in its own axes as one beam, or its inner or outer half as a component. */
static void half_beam(fb_beam *out, fb_modes *basis, int half, int elements, fb_root root, fb_basis kind)
{
  static fb_modes_desc keep;
  const fb_real third = FB_R(1.0) / FB_R(3.0);
  memset(&beam_desc, 0, sizeof beam_desc);
  memset(&keep, 0, sizeof keep);
  beam_desc.length = half < 0 ? FB_R(6.0) : half ? FB_R(4.0) : FB_R(2.0); /* a third and two thirds */
  beam_desc.position[0] = half > 0 ? FB_R(6.0) * third + FB_R(0.5) : FB_R(0.5);
  beam_desc.attitude[0] = half > 0 ? (fb_real)cos(0.5 * half_turn) : FB_R(1.0);
  beam_desc.attitude[1] = half > 0 ? (fb_real)sin(0.5 * half_turn) : FB_R(0.0);
  beam_desc.n_element = elements;
  beam_desc.root = root;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = FB_R(1.3) * half_unit;
  beam_desc.station[0].EI_y = FB_R(50.0) * half_unit;
  beam_desc.station[0].EI_z = FB_R(80.0) * half_unit;
  beam_desc.station[0].i_y = beam_desc.station[0].i_z = FB_R(0.01) * half_unit;
  keep.basis = kind;
  keep.count[FB_KIND_BEND_Y] = kind == FB_BASIS_MODES ? 3 : 1;
  keep.count[FB_KIND_BEND_Z] = kind == FB_BASIS_MODES ? 4 : 1;
  keep.cubic = 1;
  keep.n_boundary = kind == FB_BASIS_COMPONENT ? 4 : 0;
  for (int i = 0; i < keep.n_boundary; i++) {
    static const int axis[4] = {1, 2, 4, 5};
    keep.boundary[i].node = half ? 0 : elements;
    keep.boundary[i].axis = axis[i];
  }
  FBT_INT_EQ(fb_beam_init(out, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(basis, &modes_work, out, &keep), FB_OK);
}

/* E7.11, E7.12, E8.2: a beam cut at a third, with all finite-element coordinates of both parts, welded again: the
   frequencies of the uncut beam, and the body of the parts has its integrals, the quadratic field, which goes on from
   the weld, among them. Modes agree but for their sign, which the tip tells. A second, redundant weld changes
   nothing. */
TEST(joined_halves_are_the_whole)
{
  static fb_beam part[2];
  static fb_modes basis[2], joined[2];
  static fb_join_work join_work;
  static fb_shape whole;
  static const fb_weld weld[2] = {{{0, 1}, {2, 0}}, {{1, 0}, {0, 2}}};
  double largest = 0.0, sign[7];
  int node, tip;
  half_beam(&beam, &modes, -1, 6, FB_ROOT_CLAMPED, FB_BASIS_MODES);
  FBT_INT_EQ(fb_shape_init(&whole, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&whole, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&whole, &tip, 0, &beam, &modes, FB_R(6.0)), FB_OK);
  half_beam(&part[0], &basis[0], 0, 2, FB_ROOT_CLAMPED, FB_BASIS_ELEMENTS);
  half_beam(&part[1], &basis[1], 1, 4, FB_ROOT_FREE, FB_BASIS_ELEMENTS);
  for (int redundant = 0; redundant < 2; redundant++) {
    FBT_INT_EQ(joined_by(joined, &join_work, part, basis, 2, weld, 1 + redundant, 7, FB_R(0.0)), FB_OK);
    for (int k = 0; k < 7; k++) {
      largest = fmax(largest, fabs((double)(joined[0].omega[k] / modes.omega[k]) - 1.0));
      FBT_INT_EQ(joined[1].kind[k], modes.kind[k]);
    }
  }
  FBT_BELOW(largest, FBT_TOL(1e-8, 1e-3));
  fbt_figure("beam cut and joined, nothing truncated", "uncut beam", largest);
  FBT_INT_EQ(fb_shape_init(&shape, 7), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &part[0], &joined[0]), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &part[1], &joined[1]), FB_ERR_VALUE); /* nothing to hang from yet */
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &part[0], &joined[0], FB_R(2.0)), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &part[1], &joined[1]), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &part[1], &joined[1], FB_R(4.0)), FB_OK);
  FBT_NEAR_REL(shape.mass, 7.8, FBT_TOL(1e-14, 1e-6));
  for (int a = 0; a < 7; a++) {
    const int axis = modes.kind[a] == FB_KIND_BEND_Y ? 1 : 2;
    sign[a] = (double)(shape.node[node].psi[3 * a + axis] / whole.node[tip].psi[3 * a + axis]);
    FBT_NEAR_ABS(fabs(sign[a]), 1.0, FBT_TOL(1e-7, 1e-2));
    sign[a] = sign[a] < 0.0 ? -1.0 : 1.0;
  }
  for (int a = 0; a < 7; a++) {
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(shape.P[3 * a + i], sign[a] * (double)whole.P[3 * a + i], FBT_TOL(1e-6, 2e-2));
      FBT_NEAR_ABS(shape.H[3 * a + i], sign[a] * (double)whole.H[3 * a + i], FBT_TOL(1e-6, 5e-2));
    }
    for (int b = 0; b < 7; b++) {
      const int ab = a * 7 + b;
      FBT_NEAR_ABS(shape.M[ab], a == b, FBT_TOL(1e-9, 1e-3));
      FBT_NEAR_ABS(shape.K[ab], a == b ? pow((double)modes.omega[a], 2.0) : 0.0,
                   FBT_TOL(1e-6, 1e-2) * pow((double)modes.omega[6], 2.0));
      for (int i = 0; i < 9; i++) {
        FBT_NEAR_ABS(shape.second.Gamchi[9 * ab + i], sign[a] * sign[b] * (double)whole.second.Gamchi[9 * ab + i],
                     FBT_TOL(1e-5, 5e-2) * (1.0 + fabs((double)whole.second.Gamchi[9 * ab + i])));
      }
    }
    for (int b = 0; b <= a; b++) {
      const int pair = 3 * (a * (a + 1) / 2 + b);
      for (int i = 0; i < 3; i++) {
        FBT_NEAR_ABS(shape.node[node].chi[pair + i], sign[a] * sign[b] * (double)whole.node[tip].chi[pair + i],
                     FBT_TOL(1e-5, 5e-2) * (1.0 + fabs((double)whole.node[tip].chi[pair + i])));
      }
    }
  }
}

/* E7.12: a boom of two joined parts whose root is clamped has no rigid-body modes, however stiff it is along its line:
   its slow modes are found, or the precision does not do. */
TEST(slow_modes_of_joined_parts_are_not_taken_for_rigid_ones)
{
  static fb_beam part[2];
  static fb_modes basis[2], joined[2];
  static fb_join_work join_work;
  static fb_modes_desc keep;
  static const fb_weld weld[1] = {{{0, 1}, {2, 0}}};
  fb_real slow[2] = {FB_R(0.0), FB_R(0.0)};
  int found = 0;
  for (int stiff = 0; stiff < 40; stiff++) {
    fb_status status;
    for (int k = 0; k < 2; k++) {
      half_beam(&part[k], &basis[k], k, 2, k ? FB_ROOT_FREE : FB_ROOT_CLAMPED, FB_BASIS_ELEMENTS);
      beam_desc.station[0].EA = (fb_real)(2e3 * pow(1.4, stiff));
      beam_desc.attitude[0] = k ? FB_R(0.8) : FB_R(1.0); /* the outer one turned about y */
      beam_desc.attitude[2] = k ? FB_R(0.6) : FB_R(0.0);
      beam_desc.n_lump = k; /* and heavy at its end */
      beam_desc.lump[0].node = 2 * k;
      beam_desc.lump[0].mass = FB_R(5.0) * (fb_real)k;
      memset(&keep, 0, sizeof keep);
      keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = keep.count[FB_KIND_AXIAL] = 1;
      keep.rigid = k;
      FBT_INT_EQ(fb_beam_init(&part[k], &beam_desc), FB_OK);
      FBT_INT_EQ(fb_modes_solve(&basis[k], &modes_work, &part[k], &keep), FB_OK);
    }
    status = joined_by(joined, &join_work, part, basis, 2, weld, 1, 2, FB_R(0.0));
    if (stiff > 0 && status == FB_ERR_CONVERGENCE) {
      continue;
    }
    FBT_INT_EQ(status, FB_OK);
    found++;
    for (int k = 0; k < 2; k++) {
      slow[k] = stiff == 0 ? joined[0].omega[k] : slow[k];
      FBT_NEAR_REL(joined[0].omega[k], slow[k], 1e-2);
    }
  }
  FBT_TRUE(found >= FBT_TOL(40, 3));
}

/* E7.11, E7.12: what is redundant in the welds, up to rounding, does not depend on the unit of mass. */
TEST(joints_know_no_unit_of_mass)
{
  static fb_beam part[2];
  static fb_modes basis[2], joined[2];
  static fb_join_work join_work;
  static const fb_weld weld[2] = {{{0, 1}, {2, 0}}, {{1, 0}, {0, 2}}};
  double omega[4];
  for (int k = 0; k < 3; k++) {
    half_unit = (fb_real)ldexp(1.0, k == 0 ? 0 : k == 1 ? 40 : -40);
    half_beam(&part[0], &basis[0], 0, 2, FB_ROOT_CLAMPED, FB_BASIS_ELEMENTS);
    half_beam(&part[1], &basis[1], 1, 3, FB_ROOT_FREE, FB_BASIS_ELEMENTS);
    FBT_INT_EQ(joined_by(joined, &join_work, part, basis, 2, weld, 2, 4, FB_R(0.0)), FB_OK);
    for (int a = 0; a < 4; a++) {
      omega[a] = k == 0 ? (double)joined[0].omega[a] : omega[a];
      FBT_NEAR_REL(joined[0].omega[a], omega[a], FBT_TOL(1e-9, 1e-3));
    }
  }
  half_unit = FB_R(1.0);
}

/* E8.32: the quadratic field of a free beam that is heavier to one end, and with bodies on it, leaves the mass of the
   line where it is: int chi dm is nothing beside the mass times what the tip moves. */
TEST(a_free_beam_bends_about_its_mass_center)
{
  for (int lumps = 0; lumps < 2; lumps++) {
    static fb_modes_desc keep;
    double largest = 0.0;
    int tip;
    half_beam(&beam, &modes, -1, 4, FB_ROOT_FREE, FB_BASIS_MODES);
    memset(&keep, 0, sizeof keep);
    keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 2;
    beam_desc.n_station = 2;
    beam_desc.station[1] = beam_desc.station[0];
    beam_desc.station[1].x = beam_desc.length;
    beam_desc.station[1].mass = FB_R(9.0) * beam_desc.station[0].mass;
    beam_desc.n_lump = 2 * lumps;
    beam_desc.lump[0].node = 2;
    beam_desc.lump[1].node = 4;
    beam_desc.lump[0].mass = beam_desc.lump[1].mass = (fb_real)(5 * lumps);
    FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
    FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &tip, 0, &beam, &modes, beam_desc.length), FB_OK);
    for (int i = 0; i < 3 * modes.n * (modes.n + 1) / 2; i++) {
      largest = fmax(largest, fabs((double)(shape.mass * shape.node[tip].chi[i])));
    }
    FBT_TRUE(largest > 0.01);
    FBT_BELOW(fbt_largest(shape.second.pchi, 3 * modes.n * modes.n), 1e-3 * largest);
  }
}

/* E7.12: halves turned against each other about their line have modes that bend both ways: one has the kind of the
   coordinate with the largest share, in units of its modal mass, and the sign in which that is positive. */
TEST(joined_modes_are_of_the_kind_of_their_largest_share)
{
  static fb_beam part[2];
  static fb_modes basis[2], joined[2];
  static fb_join_work join_work;
  static const fb_weld weld = {{0, 1}, {2, 0}};
  for (int turn = 1; turn <= 6; turn++) {
    half_turn = 0.25 * turn;
    half_beam(&part[0], &basis[0], 0, 2, FB_ROOT_CLAMPED, FB_BASIS_ELEMENTS);
    half_beam(&part[1], &basis[1], 1, 4, FB_ROOT_FREE, FB_BASIS_ELEMENTS);
    FBT_INT_EQ(joined_by(joined, &join_work, part, basis, 2, &weld, 1, 7, FB_R(0.0)), FB_OK);
    for (int k = 0; k < 7; k++) {
      double best = 0.0, of_kind[FB_KIND_COUNT] = {0.0};
      for (int ca = 0; ca < basis[0].n + basis[1].n; ca++) {
        const int c = ca >= basis[0].n, a = c ? ca - basis[0].n : ca, ndof = basis[c].ndof;
        const double own = (double)basis[c].M[a * (basis[c].n + 1)];
        double share = 0.0, size = 0.0;
        for (int i = 0; i < ndof; i++) { /* a coordinate of an element moves nothing that another one moves */
          share += (double)joined[c].shape[k * ndof + i] * (double)basis[c].shape[a * ndof + i];
          size += pow((double)basis[c].shape[a * ndof + i], 2.0);
        }
        share *= sqrt(own) / size;
        best = fabs(share) > fabs(best) ? share : best;
        of_kind[basis[c].kind[a]] = fmax(of_kind[basis[c].kind[a]], fabs(share));
      }
      FBT_TRUE(best > 0.0);
      FBT_NEAR_REL(of_kind[joined[0].kind[k]], fabs(best), FBT_TOL(1e-6, 1e-2));
      FBT_INT_EQ(joined[1].kind[k], joined[0].kind[k]);
    }
  }
  half_turn = 0.0;
}

/* E7.12: a beam of two halves that are each other's mirror image: every mode has an equal share in both, and the same
   sign whatever rounding makes of them. */
TEST(joined_twins_have_a_sign_that_rounding_does_not_choose)
{
  static fb_beam part[2];
  static fb_modes basis[2], joined[2];
  static fb_join_work join_work;
  static fb_modes_desc keep;
  static const fb_weld tips = {{0, 1}, {2, 2}};
  const int roundings = FB_SINGLE ? 0 : 16; /* in single those of the halves' own modes are too many for a tie */
  double first[5] = {0.0};
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Y] = 5;
  for (int run = -2; run <= 2; run++) {
    for (int half = 0; half < 2; half++) {
      memset(&beam_desc, 0, sizeof beam_desc);
      beam_desc.length = FB_R(2.0);
      beam_desc.n_element = 2;
      beam_desc.position[0] = half ? FB_R(4.0) : FB_R(0.0);
      beam_desc.attitude[half ? 3 : 0] = FB_R(1.0); /* half a turn about z */
      beam_desc.n_station = 1;
      beam_desc.station[0].mass = FB_R(1.3);
      beam_desc.station[0].EI_z = FB_R(80.0) * (FB_R(1.0) + (fb_real)(roundings * half * run) * FB_EPSILON);
      FBT_INT_EQ(fb_beam_init(&part[half], &beam_desc), FB_OK);
      FBT_INT_EQ(fb_modes_solve(&basis[half], &modes_work, &part[half], &keep), FB_OK);
    }
    FBT_INT_EQ(joined_by(joined, &join_work, part, basis, 2, &tips, 1, 5, FB_R(0.0)), FB_OK);
    for (int k = 0; k < 5; k++) {
      const double middle = (double)joined[1].shape[k * joined[1].ndof + 7], sign = middle < 0.0 ? -1.0 : 1.0;
      FBT_NEAR_ABS(fabs((double)joined[0].shape[k * joined[0].ndof + 7]), fabs(middle), FBT_TOL(1e-9, 1e-3));
      first[k] = run == -2 ? sign : first[k];
      FBT_NEAR_ABS(sign, first[k], 0.0);
    }
  }
}

/* E8.8: a sound body passes its check in any unit of mass and time; its radius of gyration is the root of the mean
   square of the distance from O: (a^2 + a b + b^2)/3 of a line from a to b, and the sections' own. Held, its bound at
   rest is its highest frequency; effects that are off have none. */
TEST(bodies_are_sound_in_any_unit)
{
  for (int k = 0; k < 9; k++) {
    const double soft = ldexp(1.0, 12 * (k / 3 - 1));
    static fb_modes_desc keep;
    fb_body_desc level;
    half_unit = (fb_real)ldexp(1.0, 20 * (k % 3 - 1));
    half_beam(&beam, &modes, -1, 6, FB_ROOT_CLAMPED, FB_BASIS_MODES);
    beam_desc.station[0].EI_y *= (fb_real)soft;
    beam_desc.station[0].EI_z *= (fb_real)soft;
    memset(&keep, 0, sizeof keep);
    keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 1;
    FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
    FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
    memset(&level, 0, sizeof level);
    level.effects = FB_EFFECTS_FULL;
    level.base = FB_BASE_PRESCRIBED;
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
    FBT_INT_EQ(fb_body_check(&body), FB_OK);
    FBT_NEAR_REL(body.gyration, sqrt((6.5 * 6.5 + 6.5 * 0.5 + 0.5 * 0.5) / 3.0 + 0.02 / 1.3), FBT_TOL(1e-12, 1e-5));
    FBT_NEAR_REL(body.limit_elastic, modes.omega[modes.n - 1] * modes.omega[modes.n - 1], FBT_TOL(1e-9, 1e-4));
    FBT_TRUE(body.recoil == FB_R(1.0) && body.limit_spin > FB_R(0.0) && body.limit_acceleration > FB_R(0.0));
    level.effects = FB_EFFECTS_LINEAR;
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
    FBT_TRUE(body.limit_spin == FB_R(0.0) && body.limit_acceleration == FB_R(0.0) && body.limit_damping == FB_R(0.0));
    FBT_TRUE(body.limit_slope == FB_R(0.0) && body.limit_tension == FB_R(0.0));
  }
  half_unit = FB_R(1.0);
}

/* E7.12: a rod cut in two that keeps one common mode, along x alone: its outer half hangs from a node at the weld, as
   every other does. */
TEST(joined_rods_hang_from_their_weld)
{
  static fb_beam part[2];
  static fb_modes basis[2], joined[2];
  static fb_modes_desc keep;
  static fb_join_work join_work;
  static const fb_weld weld = {{0, 1}, {1, 0}};
  int node;
  for (int c = 0; c < 2; c++) {
    memset(&beam_desc, 0, sizeof beam_desc);
    memset(&keep, 0, sizeof keep);
    beam_desc.length = FB_R(1.0);
    beam_desc.position[0] = (fb_real)c;
    beam_desc.n_element = 1;
    beam_desc.root = c ? FB_ROOT_FREE : FB_ROOT_CLAMPED;
    beam_desc.n_station = 1;
    beam_desc.station[0].mass = FB_R(2.0);
    beam_desc.station[0].EA = FB_R(7.0);
    keep.basis = FB_BASIS_ELEMENTS;
    keep.count[FB_KIND_AXIAL] = 1;
    FBT_INT_EQ(fb_beam_init(&part[c], &beam_desc), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&basis[c], &modes_work, &part[c], &keep), FB_OK);
  }
  FBT_INT_EQ(joined_by(joined, &join_work, part, basis, 2, &weld, 1, 1, FB_R(0.0)), FB_OK);
  FBT_INT_EQ(joined[1].kind[0], FB_KIND_AXIAL);
  FBT_NEAR_REL(joined[0].omega[0], 1.5707963267948966 / 2.0 * sqrt(7.0 / 2.0), 0.03); /* two elements of first degree */
  FBT_INT_EQ(fb_shape_init(&shape, 1), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &part[0], &joined[0]), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &part[1], &joined[1]), FB_ERR_VALUE);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &part[0], &joined[0], FB_R(1.0)), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &part[1], &joined[1]), FB_OK);
}

/* E7.11, E7.12: Craig-Bampton halves: the error falls as modes are kept; a free-flying pair has no rigid modes left and
   the frequencies of the free beam; what cannot be joined is refused. */
TEST(joined_components_converge_and_refuse)
{
  static fb_beam part[2];
  static fb_modes basis[2], joined[2];
  static fb_modes_desc keep;
  static fb_join_work join_work;
  fb_weld weld = {{0, 1}, {2, 0}};
  fb_status status;
  double before = 1.0;
  half_beam(&beam, &modes, -1, 6, FB_ROOT_FREE, FB_BASIS_MODES);
  for (int count = 1; count <= 3; count++) {
    double largest = 0.0;
    for (int c = 0; c < 2; c++) {
      half_beam(&part[c], &basis[c], c, c ? 4 : 2, FB_ROOT_FREE, FB_BASIS_ELEMENTS); /* for the beam */
      memset(&keep, 0, sizeof keep);
      keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = count;
      keep.rigid = keep.cubic = 1;
      keep.n_load = 4; /* residual flexibility at the weld */
      for (int i = 0; i < 4; i++) {
        static const int axis[4] = {1, 2, 4, 5};
        keep.load[i].node = c ? 0 : 2;
        keep.load[i].axis = axis[i];
      }
      if (count == 3 && c == 0) { /* two elements have four elastic shapes a plane: forces complete them */
        FBT_INT_EQ(fb_modes_solve(&basis[c], &modes_work, &part[c], &keep), FB_ERR_MODES);
        keep.n_load = 2;
        memset(keep.load + 2, 0, 2 * sizeof *keep.load);
      }
      FBT_INT_EQ(fb_modes_solve(&basis[c], &modes_work, &part[c], &keep), FB_OK);
    }
    status = joined_by(joined, &join_work, part, basis, 2, &weld, 1, 4, FB_R(0.0));
    FBT_TRUE(status == FB_OK || (FB_SINGLE && status == FB_ERR_CONVERGENCE)); /* or it says that it cannot tell */
    for (int k = 0; k < 4 && status == FB_OK; k++) {
      largest = fmax(largest, fabs((double)(joined[0].omega[k] / modes.omega[k]) - 1.0));
    }
    FBT_BELOW(largest, count == 1 ? 2e-2 : before);
    before = fmax(largest, FBT_TOL(1e-9, 3e-2));
  }
  FBT_TRUE(joined_by(joined, &join_work, part, basis, 2, &weld, 1, 23, FB_R(0.0)) ==
           (FB_SINGLE ? FB_ERR_CONVERGENCE : FB_ERR_MODES));
  if (!FB_SINGLE) { /* all of them, whatever the unit of time; single precision has no room for the fast ones */
    const int all = basis[0].n + basis[1].n - 6 - 6; /* less the weld and rigid motion */
    for (int fast = 0; fast < 2; fast++) {
      for (int c = 0; c < 2; c++) {
        for (int i = 0; i < basis[c].n * basis[c].n; i++) {
          basis[c].K[i] *= FB_R(1e6);
        }
      }
      FBT_INT_EQ(joined_by(joined, &join_work, part, basis, 2, &weld, 1, 0, FB_R(0.0)), FB_OK);
      FBT_INT_EQ(joined[0].n, all);
      FBT_NEAR_REL(joined[0].omega[0], pow(1e3, fast + 1) * (double)modes.omega[0], 1e-6);
    }
  }
  basis[1].n = FB_MAX_MODES + 1;
  FBT_INT_EQ(joined_by(joined, &join_work, part, basis, 2, &weld, 1, 4, FB_R(0.0)), FB_ERR_CAPACITY);
  basis[1].n = -3;
  FBT_INT_EQ(joined_by(joined, &join_work, part, basis, 2, &weld, 1, 4, FB_R(0.0)), FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_modes_solve(&basis[1], &modes_work, &part[1], &keep), FB_OK);
  FBT_INT_EQ(joined_by(joined, &join_work, part, basis, 2, &weld, 1, -1, FB_R(0.0)), FB_ERR_VALUE);
  FBT_INT_EQ(joined_by(joined, &join_work, part, basis, FB_MAX_COMPONENTS + 1, &weld, 1, 0, FB_R(0.0)),
             FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_modes_join(joined, &join_work, part, basis, NULL, 2), FB_ERR_NULL);
  FBT_INT_EQ(joined_by(joined, &join_work, part, basis, 2, &weld, 1, 0, (fb_real)NAN), FB_ERR_NOT_FINITE);
  weld.node[0] = 1; /* not at the same place */
  FBT_INT_EQ(joined_by(joined, &join_work, part, basis, 2, &weld, 1, 4, FB_R(0.0)), FB_ERR_VALUE);
  weld.node[0] = 3;
  FBT_INT_EQ(joined_by(joined, &join_work, part, basis, 2, &weld, 1, 4, FB_R(0.0)), FB_ERR_CAPACITY);
  weld.node[0] = 2;
  weld.component[1] = 0; /* with itself */
  weld.node[1] = 2;
  FBT_INT_EQ(joined_by(joined, &join_work, part, basis, 2, &weld, 1, 4, FB_R(0.0)), FB_ERR_VALUE);
}

/* E8.1, E6.2: the boom's beam rebuilt as a finite-element model: lumped masses at nodes with displacements, rotations
   and rotary inertia, the quadratic integrals by pairs. With many nodes the integrals are those of the beam (midpoints:
   error 1/nodes^2); the node's loads and motions are those of the beam's node. */
TEST(finite_element_models_are_the_beams_they_came_from)
{
  static fb_shape model;
  const int nodes = 400;
  int node[2], at;
  boom(&shape, node); /* its hub and tip body stay out */
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  beam.desc.n_lump = 0;
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node[0], 0, &beam, &modes, FB_R(3.0)), FB_OK);
  FBT_INT_EQ(fb_shape_init(&model, modes.n), FB_OK);
  for (int k = 0; k < nodes; k++) {
    const fb_real x = FB_R(4.0) * ((fb_real)k + FB_R(0.5)) / (fb_real)nodes, dx = FB_R(4.0) / (fb_real)nodes;
    fb_section s;
    fb_real local[9] = {0}, half[9], J[9], inertia[6];
    const fb_node *n = &shape.node[2];
    shape.n_node = 2;
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &at, 0, &beam, &modes, x), FB_OK);
    fb_beam_section_eval(&beam, &s, x);
    local[0] = dx * (s.i_y + s.i_z);
    local[4] = dx * s.i_y;
    local[8] = dx * s.i_z;
    fb_mat33_mul(half, beam.axes, local);
    for (int i = 0; i < 9; i++) { /* A J A^T */
      J[i] = half[3 * (i / 3)] * beam.axes[3 * (i % 3)] + half[3 * (i / 3) + 1] * beam.axes[3 * (i % 3) + 1] +
             half[3 * (i / 3) + 2] * beam.axes[3 * (i % 3) + 2];
    }
    inertia[0] = J[0];
    inertia[1] = J[4];
    inertia[2] = J[8];
    inertia[3] = J[1];
    inertia[4] = J[2];
    inertia[5] = J[5];
    FBT_INT_EQ(fb_shape_add_lump(&model, dx * s.mass, n->r, inertia, n->psi, n->theta), FB_OK);
  }
  FBT_NEAR_REL(model.mass, shape.mass, FBT_TOL(1e-6, 1e-4));
  for (int a = 0; a < modes.n; a++) {
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(model.P[3 * a + i], shape.P[3 * a + i], 2e-4);
      FBT_NEAR_ABS(model.H[3 * a + i], shape.H[3 * a + i], 1e-3);
    }
    for (int b = 0; b < modes.n; b++) {
      const int ab = a * modes.n + b;
      FBT_NEAR_ABS(model.M[ab], shape.M[ab], 1e-3);
      for (int i = 0; i < 9; i++) {
        FBT_NEAR_ABS(model.second.Pi[9 * ab + i], shape.second.Pi[9 * ab + i], 1e-3);
      }
      if (b <= a) {
        const fb_real *G = shape.second.Gamchi + 9 * ab;
        fb_real rest[9];
        for (int i = 0; i < 9; i++) {
          rest[i] = G[i] - model.second.Gamchi[9 * ab + i];
        }
        FBT_INT_EQ(fb_shape_add_pair(&model, a, b, shape.second.pchi + 3 * ab, NULL, rest), FB_OK);
        for (int i = 0; i < 9; i++) {
          FBT_NEAR_ABS(model.second.Gamchi[9 * (b * modes.n + a) + i], G[i], FBT_TOL(1e-12, 1e-4));
        }
      }
    }
  }
  FBT_INT_EQ(fb_shape_add_node(&model, &at, shape.node[1].r, shape.node[1].psi, shape.node[1].theta), FB_OK);
  FBT_INT_EQ(at, 1);
  FBT_TRUE(memcmp(model.node[1].psi, shape.node[1].psi, sizeof shape.node[1].psi) == 0);
  { /* bad input leaves the model as it is */
    static fb_shape kept;
    const fb_real bad[3] = {0, (fb_real)NAN, 0}, odd[6] = {FB_R(1.0), FB_R(1.0), FB_R(3.0), 0, 0, 0};
    memcpy(&kept, &model, sizeof model);
    FBT_INT_EQ(fb_shape_add_lump(&model, -FB_R(1.0), shape.node[1].r, NULL, shape.node[1].psi, shape.node[1].theta),
               FB_ERR_VALUE);
    FBT_INT_EQ(fb_shape_add_lump(&model, FB_R(1.0), shape.node[1].r, odd, shape.node[1].psi, shape.node[1].theta),
               FB_ERR_VALUE);
    FBT_INT_EQ(fb_shape_add_lump(&model, FB_R(1.0), bad, NULL, shape.node[1].psi, shape.node[1].theta),
               FB_ERR_NOT_FINITE);
    FBT_INT_EQ(fb_shape_add_lump(&model, FB_R(1.0), shape.node[1].r, NULL, NULL, shape.node[1].theta), FB_ERR_NULL);
    FBT_INT_EQ(fb_shape_add_node(&model, NULL, shape.node[1].r, shape.node[1].psi, shape.node[1].theta), FB_ERR_NULL);
    FBT_INT_EQ(fb_shape_add_pair(&model, 0, modes.n, NULL, NULL, NULL), FB_ERR_CAPACITY);
    FBT_INT_EQ(fb_shape_add_pair(&model, 0, 1, bad, NULL, NULL), FB_ERR_NOT_FINITE);
    FBT_TRUE(memcmp(&kept, &model, sizeof model) == 0);
  }
}

SUITE(body_joined, RUN(finite_element_models_are_the_beams_they_came_from), RUN(joined_halves_are_the_whole),
      RUN(slow_modes_of_joined_parts_are_not_taken_for_rigid_ones), RUN(joints_know_no_unit_of_mass),
      RUN(a_free_beam_bends_about_its_mass_center), RUN(joined_modes_are_of_the_kind_of_their_largest_share),
      RUN(joined_twins_have_a_sign_that_rounding_does_not_choose), RUN(bodies_are_sound_in_any_unit),
      RUN(joined_rods_hang_from_their_weld), RUN(joined_components_converge_and_refuse))
