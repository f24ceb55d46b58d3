/* >>modes: which modes are chosen, their signs, masses and units; functions; what is refused. */
#include "modes.h"

static fb_modes modes, other, pattern;

/* E7.2: the lowest modes of all kinds are those that counts find, of a clamped and, behind its rigid ones, of a free
   beam; also where it is soft along its axis, or about it. */
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

/* E7.2: the lowest modes of a round beam, whose bending modes come in pairs: a list that ends with a pair lacks no mode
   below it. */
TEST(the_lowest_modes_may_end_with_a_pair)
{
  fb_real omega[8];
  fb_modes_desc *keep;
  uniform_desc(8, FB_ROOT_CLAMPED);
  desc.length = FB_R(5.0);
  desc.station[0].mass = FB_R(0.5);
  desc.station[0].EA = FB_R(1e5);
  desc.station[0].EI_y = desc.station[0].EI_z = FB_R(400.0);
  desc.station[0].i_y = desc.station[0].i_z = FB_R(0.01);
  desc.station[0].GJ = FB_R(300.0); /* the first mode of torsion is between the second and the third pair */
  keep = choice();
  keep->lowest = 8;
  FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
  memcpy(omega, modes.omega, sizeof omega);
  FBT_INT_EQ(modes.kind[4], FB_KIND_TORSION);
  for (int n = 1; n < 8; n++) {
    keep->lowest = n;
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), FB_OK);
    FBT_INT_EQ(modes.n, n);
    for (int k = 0; k < n; k++) {
      FBT_NEAR_REL(modes.omega[k], omega[k], FBT_TOL(1e-9, 1e-4));
    }
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
        memset(desc.lump, 0, sizeof desc.lump);
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
TEST(a_round_beam_has_pairs_of_unexact_modes)
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

/* Interface: counts and the frequency limit select from one ordered list. */
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

/* Interface: finite-element coordinates are unit shapes, M and K those of fb_beam_matrices_eval without the held and
   the unwanted rows. */
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
      fb_beam_matrices_eval(&beam, K, M);
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

/* desc and keep are refused with the status, and the modes keep every byte. */
static void refused(const fb_modes_desc *keep, fb_status expected)
{
  memset(&pattern, 0xA5, sizeof pattern);
  memset(&modes, 0xA5, sizeof modes);
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, keep), expected);
  FBT_TRUE(memcmp(&modes, &pattern, sizeof modes) == 0);
}

/* Interface: what a beam cannot have is refused: kinds without stiffness or inertia, more modes than coordinates or
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
      refused(&keep, what == 2 ? FB_ERR_MODES : FB_ERR_KIND);
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
  refused(&keep, FB_ERR_UNSUPPORTED);
  keep.root_strain = 0;
  keep.count[FB_KIND_BEND_Z] = 5; /* two elements have four */
  refused(&keep, FB_ERR_MODES);
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

/* Interface: as many coordinates as there is room for, and no more: natural modes, with corrections behind them or
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
        fb_coordinate *const at = keep->n_load > 0 ? keep->load : keep->boundary;
        at[k].node = keep->n_load + keep->n_boundary > 0 ? 4 : 0;
        at[k].axis = keep->n_load + keep->n_boundary > 0 ? k : 0;
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
    memset(desc.lump, 0, sizeof desc.lump);
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

/* E7.7: a body of mass m at the tip of a beam without mass: its coordinate has the momentum m and the angular momentum
   m L, the others have none, whatever the work held. There is no effective mass: the mass matrix is singular. */
TEST(momenta_are_told_of_beams_without_mass)
{
  for (int byte = 0; byte < 256; byte += 255) {
    static fb_modes_desc keep;
    double tip = 0.0, rest = 0.0;
    uniform_desc(2, FB_ROOT_CLAMPED);
    memset(&keep, 0, sizeof keep);
    keep.basis = FB_BASIS_ELEMENTS;
    keep.count[FB_KIND_BEND_Y] = 1;
    desc.station[0].mass = FB_R(0.0);
    desc.n_lump = 1;
    desc.lump[0].node = 2;
    desc.lump[0].mass = FB_R(3.0);
    FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
    memset(&work, byte, sizeof work);
    FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, &keep), FB_OK);
    for (int a = 0; a < modes.n; a++) {
      const fb_real *const p = modes.momentum + 6 * a;
      tip = fmax(tip, fabs((double)p[1]));
      rest += fabs((double)p[1]) + fabs((double)(p[5] - p[1] * desc.length)) + fabs((double)p[0]) + fabs((double)p[2]);
      rest += fabs((double)p[3]) + fabs((double)p[4]) + fabs((double)modes.effective[a % 6]);
    }
    FBT_NEAR_REL(tip, 3.0, FBT_TOL(1e-14, 1e-6));
    FBT_NEAR_REL(rest, 3.0, FBT_TOL(1e-13, 1e-5)); /* that coordinate alone */
  }
}

SUITE(modes_selection, RUN(momenta_are_told_of_beams_without_mass), RUN(the_lowest_modes_are_the_lowest_of_all_kinds),
      RUN(the_lowest_modes_may_end_with_a_pair), RUN(functions_are_orthonormal_and_as_smooth_as_they_claim),
      RUN(functions_of_one_direction_are_its_lowest_modes), RUN(functions_carry_the_lumped_bodies),
      RUN(the_lowest_modes_below_a_limit_are_all_below_it), RUN(modes_are_orthonormal_with_a_fixed_sign),
      RUN(a_held_tip_does_not_choose_the_sign), RUN(a_round_beam_has_pairs_of_unexact_modes),
      RUN(modes_may_fill_all_their_room), RUN(functions_of_a_changing_beam_are_its_own),
      RUN(momenta_and_effective_masses_are_those_of_the_whole_beam), RUN(bodies_couple_the_kinds_that_they_should),
      RUN(modes_are_selected_by_count_and_frequency), RUN(element_coordinates_keep_the_element_matrices),
      RUN(modes_that_do_not_exist_are_refused))
