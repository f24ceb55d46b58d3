/* >>modes: components with a boundary, attachment modes, parts that were joined. */
#include "modes.h"

static fb_modes modes, other;

/* E7.9: Hopkins' example of Hurty's method (C.3, p09_hurty.csv, ERRATA.md): one cubic element l, M, EI, the boundary q1
   = u_x and q3 = u_y, q5 = theta_z at one end, q2 = u_x at the other, one fixed-interface mode eta kept, scaled to
   phi4^2 + (l phi6)^2 = 1. */
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
   L/GA, and 2L/15GA: int V^2/GA of V = 3 s^2 - 2 s. Without the correction some percent are missing. */
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
    keep->load[0].node = corrected * (int)ELEMENTS;
    keep->load[0].axis = corrected * (1 + plane);
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

/* E7.8: beams of any length, stiffness and mass with up to six modes, which miss down to a millionth of the tip
   flexibility: the correction is there, and the flexibility as in static_corrections_make_loads_exact. */
TEST(every_load_has_its_correction)
{
  for (int run = 0; run < 200; run++) {
    const int free_root = run / 2 % 2, plane = run % 2;
    const double EI = pow(10.0, 3.0 + 2.0 * fbt_random()), L = 6.0 + 5.0 * fbt_random();
    const double exact = L * L * L / EI / (free_root ? 105.0 : 3.0);
    fb_modes_desc *keep;
    uniform_desc((int)ELEMENTS, free_root ? FB_ROOT_FREE : FB_ROOT_CLAMPED);
    desc.length = (fb_real)L;
    desc.station[0].EI_y = desc.station[0].EI_z = (fb_real)EI;
    desc.station[0].mass = (fb_real)pow(10.0, fbt_random());
    keep = choice();
    keep->count[plane ? FB_KIND_BEND_Z : FB_KIND_BEND_Y] = 1 + run / 4 % 6;
    keep->n_load = 1;
    keep->load[0].node = (int)ELEMENTS;
    keep->load[0].axis = 1 + plane;
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
    FBT_INT_EQ(modes.n, 2 + run / 4 % 6);
    FBT_NEAR_REL(tip_sum(&modes, 1 + plane), exact, FBT_TOL(1e-10, 2e-4));
  }
}

/* E7.8: a deflection that the modes hold already is no further coordinate: that of a body on a tip without mass, and of
   one element all of whose shapes are there. Nor is one that moves no mass, of a load halfway to that body. */
TEST(loads_without_a_coordinate_of_their_own_are_refused)
{
  for (int run = 0; run < 4; run++) {
    const int halfway = run == 1, whole = run >= 2;
    fb_modes_desc *keep;
    uniform_desc(whole ? 1 : 2, run == 3 ? FB_ROOT_FREE : FB_ROOT_CLAMPED);
    desc.station[0].mass = whole ? FB_R(3.0) : FB_R(0.0);
    desc.n_lump = !whole;
    desc.lump[0].node = whole ? 0 : 2;
    desc.lump[0].mass = whole ? FB_R(0.0) : FB_R(0.5);
    keep = choice();
    keep->count[FB_KIND_BEND_Y] = whole ? FB_ALL_MODES : 1;
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
    FBT_INT_EQ(modes.n, whole ? 4 : 1);
    keep->n_load = 1;
    keep->load[0].node = 2 - halfway - whole;
    keep->load[0].axis = 1;
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_ERR_MODES);
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

/* E7.8: one mode and the correction are at the tip as flexible as all modes of a beam of few elements, whatever its
   shear, taper and root: what its inertia does to a free one is of third degree along it. */
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
  FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_ERR_MODES);
}

/* E7.6: a free beam as a component: its rigid motions first, with all of its mass and inertia, none of it in the
   elastic modes; a pinned root leaves two rotations. Modal masses by the matrices that are integrated here. */
TEST(components_keep_their_rigid_motions)
{
  static const int rigid[3] = {0, 2, 6};
  static const fb_kind kind[6] = {FB_KIND_AXIAL,   FB_KIND_BEND_Y, FB_KIND_BEND_Z,
                                  FB_KIND_TORSION, FB_KIND_BEND_Z, FB_KIND_BEND_Y};
  static const double none[3] = {0};
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
    full_matrices(none);
    for (int a = 0; a < modes.n; a++) {
      FBT_TRUE((modes.omega[a] > FB_R(0.1)) == (a >= rigid[root]));
      FBT_TRUE(a >= rigid[root] ||
               modes.kind[a] == kind[6 - rigid[root] + a]); /* those of free roots, then of pinned ones */
      for (int i = 0; i < 6 && root == FB_ROOT_FREE; i++) {
        const double share = pow((double)modes.momentum[6 * a + i], 2.0) / (double)modes.rigid_mass[i];
        FBT_TRUE(a < 6 || share < FBT_TOL(1e-18, 1e-8));
      }
      for (int b = 0; b < modes.n; b++) {
        const fb_real *const x = modes.shape + a * modes.ndof, *const y = modes.shape + b * modes.ndof;
        FBT_NEAR_ABS(form(full_M, x, y), a == b, FBT_TOL(1e-12, 1e-4));
      }
    }
    for (int i = 0; i < 6 && root == FB_ROOT_FREE; i++) {
      FBT_NEAR_REL(modes.effective[i], 1.0, FBT_TOL(1e-12, 1e-4));
    }
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
    status = joined_by(common, &join_work, limb, limb_basis, 3, weld, 2, 9, FB_R(0.0));
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
  FBT_INT_EQ(joined_by(common, &join_work, &beam, &modes, 1, NULL, 0, 0, FB_R(0.0)), FB_OK);
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
  FBT_INT_EQ(joined_by(common, &join_work, limb, limb_basis, 2, &weld, 1, 0, FB_R(0.0)), FB_OK);
  FBT_INT_EQ(common[0].n + common[1].n, 0);
}

/* E7.12: of parts that nothing joins the common modes are those of each, also where the last one flies free: its rigid
   motions are none of them. */
TEST(parts_without_welds_keep_their_modes)
{
  int n = 0;
  for (int c = 0; c < 2; c++) {
    fb_modes_desc *keep;
    uniform_desc(2, c ? FB_ROOT_FREE : FB_ROOT_CLAMPED);
    desc.station[0].i_y = desc.station[0].i_z = FB_R(0.05);
    keep = choice();
    keep->rigid = c;
    keep->count[FB_KIND_BEND_Y] = 2;
    FBT_INT_EQ(fb_modes_solve(&limb_basis[c], &work, &beam, keep), FB_OK);
    limb[c] = beam;
  }
  FBT_INT_EQ(joined_by(common, &join_work, limb, limb_basis, 2, NULL, 0, 0, FB_R(0.0)), FB_OK);
  FBT_INT_EQ(common[0].n, 4);
  for (int c = 0; c < 2; c++) {
    for (int a = 0; a < limb_basis[c].n; a++) {
      double nearest = HUGE_VAL;
      for (int k = 0; k < common[0].n; k++) {
        nearest = fmin(nearest, fabs((double)common[0].omega[k] / (double)limb_basis[c].omega[a] - 1.0));
      }
      n += nearest < FBT_TOL(1e-9, 1e-4);
    }
  }
  FBT_INT_EQ(n, 4);
}

/* Interface: the work of the modes of a beam is two full matrices and rows as long as a row couples with, that of a
   synthesis five full matrices: with n coordinates 2 n^2 and 5 n^2 numbers, the rest grows with n. */
TEST(work_structs_hold_no_more_than_their_matrices)
{
  const double n = 22.0 * FB_MAX_ELEMENTS + 6.0, joined = FB_MAX_COMPONENTS * FB_MAX_MODES;
  const double rows = 6.0 * FB_MAX_WELDS > joined ? 6.0 * FB_MAX_WELDS : joined, real = sizeof(fb_real);
  FBT_BELOW((sizeof(fb_modes_work) - sizeof(fb_modes)) / real, (2.0 * n + 115.0) * n);
  FBT_BELOW((sizeof(fb_join_work) - sizeof(fb_modes)) / real, (4.0 * joined + rows + 4.0) * joined);
}

SUITE(modes_components, RUN(hurty_example_has_the_printed_numbers),
      RUN(boundaries_that_move_a_free_component_have_no_negative_stiffness),
      RUN(components_deflect_exactly_at_their_boundary), RUN(static_corrections_make_loads_exact),
      RUN(every_load_has_its_correction), RUN(loads_without_a_coordinate_of_their_own_are_refused),
      RUN(effective_masses_add_up_to_the_beam), RUN(components_keep_their_rigid_motions),
      RUN(one_mode_and_its_correction_are_as_good_as_all),
      RUN(components_with_shear_deflect_exactly_in_every_direction), RUN(a_part_alone_keeps_its_modes),
      RUN(a_component_of_all_nodes_has_the_stiffness_of_the_elements), RUN(a_free_chain_has_the_inertia_of_its_rods),
      RUN(welded_limbs_are_the_chain_of_their_elements), RUN(rigid_parts_have_no_common_modes),
      RUN(parts_without_welds_keep_their_modes), RUN(work_structs_hold_no_more_than_their_matrices))
