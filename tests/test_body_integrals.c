/* >>body and >>assemble: shape integrals of beams, lumps and finite-element models; the quadratic field. */
#include "body.h"

static fb_shape other;

/* ---- every set of effects against its own Lagrangian, formed from the particles without shape integrals */

/* Two scalar functions of the place. */
static double scalar_function(const double r[3], int which)
{
  return rounded(which ? 0.3 * sin(2.0 * r[0]) + 0.2 * r[1] : 0.4 * r[0] * r[0] - 0.1 * r[2]);
}

/* E8.6: with the same functions in x, y and z the residual inertia is zero, term by term. */
TEST(residual_inertia_vanishes_on_a_rotation_closed_basis)
{
  fb_body_desc desc;
  particles_random(&cloud, 6, 0);
  for (int i = 0; i < PARTICLES; i++) {
    for (int a = 0; a < 6; a++) {
      const double f = scalar_function(cloud.r[i], a >= 3);
      for (int k = 0; k < 3; k++) {
        cloud.psi[i][a][k] = a % 3 == k ? f : 0.0;
      }
    }
  }
  particles_to_shape(&shape, &cloud);
  memset(&desc, 0, sizeof desc);
  desc.effects = FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA;
  desc.allow_split_effects = 1;
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  FBT_TRUE(!body.constant_S);
  FBT_INT_EQ(body.n_S, 0);    /* the constant part alone: every other term vanished to rounding */
  cloud.psi[0][0][0] += 0.01; /* not closed any more */
  particles_to_shape(&shape, &cloud);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  FBT_TRUE(body.n_S > 0);
}

/* ---- a boom with everything on it */

/* E7.5, E8.4, E8.6: the same functions in each direction make a closed basis: S is constant and spin couples a function
   with itself alone. The function with strain at the root opens it. */
TEST(functions_close_the_basis)
{
  for (int root = 0; root < 2; root++) {
    static fb_modes_desc keep;
    static fb_body_desc desc;
    const int m = 3;
    memset(&beam_desc, 0, sizeof beam_desc);
    memset(&keep, 0, sizeof keep);
    memset(&desc, 0, sizeof desc);
    beam_desc.length = FB_R(3.0);
    beam_desc.n_element = 2;
    beam_desc.n_station = 1;
    beam_desc.station[0].mass = FB_R(2.0);
    beam_desc.station[0].EI_y = FB_R(5.0);
    beam_desc.station[0].EI_z = FB_R(7.0);
    beam_desc.station[0].EA = FB_R(900.0);
    beam_desc.n_lump = 1;
    beam_desc.lump[0].node = 2;
    beam_desc.lump[0].mass = FB_R(0.5);
    keep.basis = FB_BASIS_FUNCTIONS;
    keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = keep.count[FB_KIND_AXIAL] = m;
    keep.root_strain = root;
    desc.effects = FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA;
    desc.allow_split_effects = 1;
    desc.base = FB_BASE_PRESCRIBED;
    FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
    FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
    FBT_TRUE(body.unit_mass);
    FBT_BELOW(fbt_difference(shape.M, modes.M, modes.n * modes.n), FBT_TOL(1e-13, 1e-5));
    FBT_INT_EQ(body.n_lambda - body.n_lambda_constant, 6 * m);
    FBT_INT_EQ(body.n_S == 0, !root);
  }
}

/* E8.1 to E8.3, E7.3: the quadrature over the beam reproduces the modal mass, and mass and inertia of the whole. */
TEST(beam_integrals_reproduce_mass_and_modal_mass)
{
  int node[2];
  boom(&shape, node);
  FBT_NEAR_REL(shape.mass, 6.0 + 4.0 * 0.8 + 0.3, FBT_TOL(1e-14, 1e-6));
  for (int a = 0; a < BOOM_MODES; a++) {
    for (int b = 0; b < BOOM_MODES; b++) {
      FBT_NEAR_ABS(shape.M[a * BOOM_MODES + b], a == b, FBT_TOL(1e-13, 2e-5));
    }
  }
}

/* E6.12, E6.11, E8.1: with twist, shear, every center off the line and a bent line the quadrature over the slices, each
   a rigid body placed by psi, still finds M = 1 of the eigenproblem, which integrates the fields of the section; mass,
   first moment and inertia are those of slices summed here. */
TEST(beam_integrals_hold_for_any_section_and_line)
{
  int node[2];
  double c[3] = {0.0, 0.0, 0.0}, trace = 0.0, mass = 0.0;
  boom(&shape, node);
  beam_desc.n_point = 6;
  for (int k = 0; k < 6; k++) {
    const double x = 0.8 * k;
    beam_desc.point[k][0] = (fb_real)x;
    beam_desc.point[k][1] = (fb_real)(0.04 * x * x);
    beam_desc.point[k][2] = (fb_real)(-0.02 * x * x);
  }
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_ERR_VALUE); /* the last station is not at the chain's end */
  beam_desc.station[1].x = FB_R(0.0);
  for (int k = 0; k < 5; k++) {
    double along = 0.0;
    for (int i = 0; i < 3; i++) {
      along += pow((double)beam_desc.point[k + 1][i] - (double)beam_desc.point[k][i], 2.0);
    }
    beam_desc.station[1].x += (fb_real)sqrt(along);
  }
  for (int k = 0; k < 2; k++) {
    fb_section *s = &beam_desc.station[k];
    s->GA_y = FB_R(300.0);
    s->GA_z = FB_R(500.0);
    s->twist = FB_R(0.4) - FB_R(0.9) * (fb_real)k;
    s->mass_y = FB_R(0.05);
    s->mass_z = -FB_R(0.08);
    s->tension_y = FB_R(0.03);
    s->tension_z = FB_R(0.02) * (fb_real)k;
    s->shear_y = -FB_R(0.04);
    s->shear_z = FB_R(0.06);
  }
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  for (int element_basis = 0; element_basis < 2; element_basis++) {
    static fb_modes_desc keep;
    memset(&keep, 0, sizeof keep);
    keep.basis = element_basis ? FB_BASIS_ELEMENTS : FB_BASIS_MODES;
    keep.count[FB_KIND_BEND_Y] = 3;
    keep.count[FB_KIND_BEND_Z] = 3;
    keep.count[FB_KIND_TORSION] = element_basis ? 0 : 1;
    FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
    FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
    for (int a = 0; a < modes.n; a++) {
      for (int b = 0; b < modes.n; b++) {
        const double size = sqrt((double)(modes.M[a * (modes.n + 1)] * modes.M[b * (modes.n + 1)]));
        FBT_NEAR_ABS(shape.M[a * modes.n + b], modes.M[a * modes.n + b], FBT_TOL(1e-12, 1e-4) * size);
      }
    }
  }
  for (int slice = 0; slice < 4000; slice++) {
    const double x = ((double)slice + 0.5) / 4000.0 * (double)beam.desc.length, dx = (double)beam.desc.length / 4000.0;
    int e = 0;
    fb_section s;
    double r[3], local[3], t;
    while (x > (double)beam.start[e + 1]) {
      e++;
    }
    fb_beam_section_eval(&beam, &s, (fb_real)x);
    t = (double)s.twist;
    local[0] = x - (double)beam.start[e];
    local[1] = cos(t) * (double)s.mass_y - sin(t) * (double)s.mass_z;
    local[2] = sin(t) * (double)s.mass_y + cos(t) * (double)s.mass_z;
    for (int i = 0; i < 3; i++) {
      r[i] = (double)beam.desc.position[i];
      for (int j = 0; j < 3; j++) {
        double frame = 0.0;
        for (int k = 0; k < 3; k++) {
          frame += (double)beam.axes[3 * i + k] * (double)beam.frame[9 * e + 3 * k + j];
        }
        r[i] += frame * local[j] + (double)beam.axes[3 * i + j] * (double)beam.node[3 * e + j];
      }
    }
    mass += (double)s.mass * dx;
    for (int i = 0; i < 3; i++) {
      c[i] += (double)s.mass * dx * r[i];
      trace += 2.0 * (double)s.mass * dx * r[i] * r[i];
    }
    trace += 2.0 * ((double)s.i_y + (double)s.i_z) * dx;
  }
  mass += 0.3; /* the tip body */
  FBT_NEAR_REL(shape.mass, mass, FBT_TOL(1e-9, 1e-4));
  for (int i = 0; i < 3; i++) {
    const fb_lump *tip = &beam.desc.lump[0];
    double r = (double)beam.desc.position[i];
    for (int j = 0; j < 3; j++) {
      r += (double)beam.axes[3 * i + j] * ((double)beam.node[15 + j] + (double)tip->center[j]);
    }
    FBT_NEAR_REL(shape.c[i], c[i] + 0.3 * r, FBT_TOL(1e-6, 1e-3));
    trace += 2.0 * 0.3 * r * r + (double)tip->inertia[i];
  }
  FBT_NEAR_REL(shape.J[0] + shape.J[4] + shape.J[8], trace, FBT_TOL(1e-6, 1e-3));
}

/* Displacement and rotation (1, x, y, z of exp) at x of the boom's beam alone, bent, twisted and stretched by q. */
static void bent_at(double u[3], fb_real R[9], double x, const double *q)
{
  const fb_node *n = &shape.node[1];
  fb_real phi[3] = {0}, quat[4];
  int at;
  shape.n_node = 1;
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &at, 0, &beam, &modes, (fb_real)x), FB_OK);
  for (int k = 0; k < 3; k++) {
    double turn = 0.0;
    u[k] = 0.0;
    for (int a = 0; a < modes.n; a++) {
      u[k] += (double)n->psi[3 * a + k] * q[a];
      turn += (double)n->theta[3 * a + k] * q[a];
      for (int b = 0; b < modes.n; b++) {
        const int pair = a > b ? a * (a + 1) / 2 + b : b * (b + 1) / 2 + a;
        u[k] += 0.5 * (double)n->chi[3 * pair + k] * q[a] * q[b];
        turn += 0.5 * (double)n->chi_theta[3 * pair + k] * q[a] * q[b];
      }
    }
    phi[k] = (fb_real)turn;
  }
  fb_quat_from_rotvec(quat, phi);
  fb_quat_to_mat33(R, quat);
}

/* E8.2: a beam bent in both planes and twisted. The section's normal is the tangent of the deformed line, whose length
   is unchanged, and the twist rate about it is that of the torsion coordinates: defects of third degree, 8 times less
   at half the amplitude. */
TEST(quadratic_field_is_inextensible_and_twist_free)
{
  double tangent[2], stretch[2], twist[2];
  static fb_modes_desc keep;
  int node[2];
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 2;
  keep.count[FB_KIND_TORSION] = 1;
  boom(&shape, node);
  beam_desc.n_lump = 0;
  memset(beam_desc.lump, 0, sizeof beam_desc.lump);
  memset(beam_desc.position, 0, sizeof beam_desc.position);
  memset(beam_desc.attitude, 0, sizeof beam_desc.attitude);
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  for (int scale = 0; scale < 2; scale++) {
    const double size = 0.15 / (1 + scale), h = FBT_TOL(1e-3, 0.1);
    const double q[5] = {size, -0.7 * size, 0.2 * size, 0.3 * size, 0.3 * size}, q_torsion[5] = {0};
    double q1[5];
    tangent[scale] = stretch[scale] = twist[scale] = 0.0;
    for (int a = 0; a < 5; a++) {
      q1[a] = modes.kind[a] == FB_KIND_TORSION ? q[a] : q_torsion[a];
    }
    for (double x = 0.5; x < 3.9; x += 0.4) {
      double up[3], down[3], t[3], length = 0.0;
      fb_real R[9], Ru[9], Rd[9], rate[9], linear_up[9], linear_down[9];
      bent_at(up, R, x, q);
      bent_at(up, Ru, x + h, q);
      bent_at(down, Rd, x - h, q);
      for (int k = 0; k < 3; k++) {
        t[k] = (k == 0) + (up[k] - down[k]) / (2.0 * h);
        length += t[k] * t[k];
        tangent[scale] = fmax(tangent[scale], fabs(t[k] - (double)R[3 * k]));
      }
      stretch[scale] = fmax(stretch[scale], fabs(sqrt(length) - 1.0));
      for (int k = 0; k < 9; k++) { /* kappa_x = z . y' */
        rate[k] = (Ru[k] - Rd[k]) / (fb_real)(2.0 * h);
      }
      bent_at(up, linear_up, x + h, q1);
      bent_at(down, linear_down, x - h, q1);
      {
        const double kappa = (double)(R[2] * rate[1] + R[5] * rate[4] + R[8] * rate[7]);
        const double phi =
            atan2((double)linear_up[7], (double)linear_up[8]) - atan2((double)linear_down[7], (double)linear_down[8]);
        twist[scale] = fmax(twist[scale], fabs(kappa - phi / (2.0 * h)));
      }
    }
  }
  FBT_BELOW(tangent[0], 2e-2);
  FBT_BELOW(tangent[1] / tangent[0], FBT_TOL(1.0 / 6.0, 1.0 / 3.0));
  FBT_BELOW(stretch[1] / stretch[0], FBT_TOL(1.0 / 6.0, 1.0 / 3.0));
  FBT_BELOW(twist[1] / twist[0], FBT_TOL(1.0 / 6.0, 1.0 / 3.0));
}

/* E8.2, E6.11: along a bent line, too, the deformed line has the length that the linear strain gives it, but for third
   degree; and the field turns with the beam: in an attitude R it is R times that in the body axes. */
TEST(quadratic_field_follows_a_bent_line_in_any_attitude)
{
  static fb_modes_desc keep;
  double stretch[2] = {0.0, 0.0};
  fb_real before[3 * 15], quat[4] = {FB_R(0.5), -FB_R(0.7), FB_R(0.1), FB_R(0.5)}, R[9];
  int node[2];
  boom(&shape, node);
  beam_desc.n_lump = 0;
  memset(beam_desc.lump, 0, sizeof beam_desc.lump);
  memset(beam_desc.position, 0, sizeof beam_desc.position);
  memset(beam_desc.attitude, 0, sizeof beam_desc.attitude);
  beam_desc.n_point = 6;
  for (int k = 0; k < 6; k++) {
    beam_desc.point[k][0] = FB_R(0.7) * (fb_real)k;
    beam_desc.point[k][1] = FB_R(0.07) * (fb_real)(k * k);
    beam_desc.point[k][2] = -FB_R(0.04) * (fb_real)(k * k);
  }
  beam_desc.n_station = 1;
  beam_desc.station[0].GA_y = FB_R(200.0); /* the line's slope is not the section's turn */
  beam_desc.station[0].GA_z = FB_R(300.0);
  keep.lowest = 5;
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  for (int scale = 0; scale < 2; scale++) {
    const double size = 0.15 / (1 + scale), h = FBT_TOL(1e-3, 0.05);
    const double q[5] = {size, -0.7 * size, 0.2 * size, 0.3 * size, 0.1 * size};
    for (int e = 0; e < 5; e++) {
      const double x = (double)beam.start[e] + 0.4 * ((double)beam.start[e + 1] - (double)beam.start[e]);
      double line[3] = {0.0, 0.0, 0.0}, tangent[3] = {0.0, 0.0, 0.0}, linear[3] = {0.0, 0.0, 0.0};
      double strain = 0.0, length = 0.0;
      for (int side = -1; side < 2; side += 2) {
        const fb_node *n = &shape.node[1];
        shape.n_node = 1;
        FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node[0], 0, &beam, &modes, (fb_real)(x + side * h)), FB_OK);
        for (int i = 0; i < 3; i++) {
          double u = 0.0, second = 0.0;
          for (int a = 0; a < 5; a++) {
            u += (double)n->psi[3 * a + i] * q[a];
            for (int b = 0; b < 5; b++) {
              second += 0.5 * q[a] * q[b] * (double)n->chi[3 * (a > b ? a * (a + 1) / 2 + b : b * (b + 1) / 2 + a) + i];
            }
          }
          line[i] += side * (double)n->r[i] / (2.0 * h);
          linear[i] += side * u / (2.0 * h);
          tangent[i] += side * ((double)n->r[i] + u + second) / (2.0 * h);
        }
      }
      for (int i = 0; i < 3; i++) {
        strain += line[i] * linear[i];
        length += tangent[i] * tangent[i];
      }
      stretch[scale] = fmax(stretch[scale], fabs(sqrt(length) - 1.0 - strain));
    }
  }
  if (!FB_SINGLE) { /* an eighth or less; in single precision it drowns in the differences */
    FBT_BELOW(stretch[1] / stretch[0], 1.0 / 5.0);
  }
  FBT_BELOW(stretch[0], 2e-3);
  shape.n_node = 1;
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node[0], 0, &beam, &modes, beam.desc.length), FB_OK);
  memcpy(before, shape.node[1].chi, sizeof before);
  memcpy(beam_desc.attitude, quat, sizeof quat);
  FBT_INT_EQ(fb_quat_normalize(quat), FB_OK);
  fb_quat_to_mat33(R, quat);
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  shape.n_node = 1;
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node[0], 0, &beam, &modes, beam.desc.length), FB_OK);
  for (int pair = 0; pair < 15; pair++) {
    fb_real turned[3];
    fb_mat33_mul_vec3(turned, R, before + 3 * pair);
    FBT_BELOW(fbt_difference(turned, shape.node[1].chi + 3 * pair, 3),
              FBT_TOL(1e-13, 1e-5) * (1.0 + fbt_largest(turned, 3)));
  }
}

/* E8.3, E8.14: a mass off the axis sits where the section carries it: the integrals of the tip body equal those of a
   particle placed by the node's own displacement and rotation. */
TEST(offset_masses_move_with_their_section)
{
  int node[2];
  double with[2][3];
  for (int k = 0; k < 2;
       k++) { /* first moment p_a with and without the tip body: the difference is mass times psi there */
    boom(&shape, node);
    if (k == 1) {
      beam_desc.n_lump = 0;
      memset(beam_desc.lump, 0, sizeof beam_desc.lump);
      FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
      FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
      FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
      FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node[0], 0, &beam, &modes, FB_R(4.0)), FB_OK);
    }
    for (int i = 0; i < 3; i++) {
      with[k][i] = (double)shape.P[3 * 4 + i];
    }
  }
  {
    fb_real d[3], local[3] = {0, FB_R(0.1), -FB_R(0.05)}, turn[3];
    fb_mat33_mul_vec3(d, beam.axes, local);
    fb_vec3_cross(turn, shape.node[node[0]].theta + 3 * 4, d);
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(with[0][i] - with[1][i], 0.3 * (double)(shape.node[node[0]].psi[3 * 4 + i] + turn[i]),
                   FBT_TOL(1e-13, 1e-6));
    }
  }
}

/* Largest difference of the integrals of two shapes, those of a from coordinate first on, relative to the largest of
   each. */
static double shape_difference(const fb_shape *a, const fb_shape *b, int first)
{
  double worst = fmax(fbt_difference(a->c, b->c, 3), fbt_difference(a->J, b->J, 9)) / fbt_largest(b->J, 9);
  for (int i = 0; i < b->n; i++) {
    const int at = first + i;
    worst = fmax(worst, fbt_difference(a->P + 3 * at, b->P + 3 * i, 3) / fbt_largest(b->P, 3 * b->n));
    worst = fmax(worst, fbt_difference(a->H + 3 * at, b->H + 3 * i, 3) / fbt_largest(b->H, 3 * b->n));
    worst = fmax(worst, fbt_difference(a->second.Gam + 9 * at, b->second.Gam + 9 * i, 9) /
                            fbt_largest(b->second.Gam, 9 * b->n));
    for (int k = 0; k < b->n; k++) {
      const int x = at * a->n + first + k, y = i * b->n + k, nn = b->n * b->n;
      worst = fmax(worst, fabs((double)(a->M[x] - b->M[y])));
      worst = fmax(worst, fabs((double)(a->K[x] - b->K[y])) / fbt_largest(b->K, nn));
      worst = fmax(worst, fbt_difference(a->second.ups + 3 * x, b->second.ups + 3 * y, 3));
      worst = fmax(worst, fbt_difference(a->second.Pi + 9 * x, b->second.Pi + 9 * y, 9));
      worst = fmax(worst, fbt_difference(a->second.pchi + 3 * x, b->second.pchi + 3 * y, 3) /
                              fbt_largest(b->second.pchi, 3 * nn));
      worst = fmax(worst, fbt_difference(a->second.hchi + 3 * x, b->second.hchi + 3 * y, 3) /
                              fbt_largest(b->second.hchi, 3 * nn));
      worst = fmax(worst, fbt_difference(a->second.Gamchi + 9 * x, b->second.Gamchi + 9 * y, 9) /
                              fbt_largest(b->second.Gamchi, 9 * nn));
    }
  }
  return worst;
}

/* E6.2, E8.1, E8.3: a lumped body with offset and full inertia is the handful of particles it is made of, each moving
   as u + (exp(phi) - 1) d with the node's displacement and rotation to second degree. */
TEST(lumped_bodies_are_the_particles_they_stand_for)
{
  double m[5], d[5][3], total = 0.0, center[3] = {0}, S[3][3] = {{0}};
  int node[2];
  fb_lump *tip = &beam_desc.lump[0];
  boom(&shape, node);
  for (int i = 0; i < 5; i++) {
    m[i] = 0.1 + 0.05 * i;
    total += m[i];
    for (int k = 0; k < 3; k++) {
      d[i][k] = 0.2 * fbt_random();
      center[k] += m[i] * d[i][k];
    }
  }
  for (int i = 0; i < 5; i++) {
    for (int k = 0; k < 3; k++) {
      for (int l = 0; l < 3; l++) {
        S[k][l] += m[i] * (d[i][k] - center[k] / total) * (d[i][l] - center[l] / total);
      }
    }
  }
  tip->mass = (fb_real)total;
  for (int k = 0; k < 3; k++) {
    tip->center[k] = (fb_real)(center[k] / total);
    tip->inertia[k] = (fb_real)(S[0][0] + S[1][1] + S[2][2] - S[k][k]);
  }
  tip->inertia[3] = -(fb_real)S[0][1];
  tip->inertia[4] = -(fb_real)S[0][2];
  tip->inertia[5] = -(fb_real)S[1][2];
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  beam_desc.n_lump = 0;
  memset(beam_desc.lump, 0, sizeof beam_desc.lump);
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_shape_init(&other, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&other, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&other, &node[0], 0, &beam, &modes, FB_R(4.0)), FB_OK);
  for (int i = 0; i < 5; i++) {
    const fb_node *n = &other.node[node[0]];
    fb_real local[3], D[3], r[3], psi[3 * BOOM_MODES], chi[3 * BOOM_MODES * BOOM_MODES];
    for (int k = 0; k < 3; k++) {
      local[k] = (fb_real)d[i][k];
    }
    fb_mat33_mul_vec3(D, beam.axes, local);
    for (int a = 0; a < BOOM_MODES; a++) {
      fb_vec3_cross(psi + 3 * a, n->theta + 3 * a, D);
      for (int b = 0; b < BOOM_MODES; b++) {
        const int pair = a > b ? a * (a + 1) / 2 + b : b * (b + 1) / 2 + a;
        fb_real t[3], ab[3], ba[3], *x = chi + 3 * (a * BOOM_MODES + b);
        fb_vec3_cross(t, n->theta + 3 * b, D);
        fb_vec3_cross(ab, n->theta + 3 * a, t);
        fb_vec3_cross(t, n->theta + 3 * a, D);
        fb_vec3_cross(ba, n->theta + 3 * b, t);
        fb_vec3_cross(x, n->chi_theta + 3 * pair, D);
        for (int k = 0; k < 3; k++) {
          x[k] += n->chi[3 * pair + k] + FB_R(0.5) * (ab[k] + ba[k]);
        }
      }
      for (int k = 0; k < 3; k++) {
        psi[3 * a + k] += n->psi[3 * a + k];
      }
    }
    for (int k = 0; k < 3; k++) {
      r[k] = n->r[k] + D[k];
    }
    FBT_INT_EQ(fb_shape_add_particle(&other, (fb_real)m[i], r, psi, chi), FB_OK);
  }
  FBT_NEAR_REL(shape.mass, other.mass, FBT_TOL(1e-14, 1e-6));
  FBT_BELOW(shape_difference(&shape, &other, 0), FBT_TOL(1e-12, 1e-4));
}

/* E8.1, E8.3: a lump on a node that moves by psi and turns by theta has M_ab = m psi_a.psi_b + theta_a.I theta_b, h_a =
   m r x psi_a + I theta_a, J = I + m (r.r - r r^T), I any tensor of inertia. */
TEST(lumps_have_the_inertia_of_their_node)
{
  static const fb_real inertia[6] = {FB_R(0.5), FB_R(0.6), FB_R(0.7), FB_R(0.1), -FB_R(0.05), FB_R(0.08)};
  static const int packed[9] = {0, 3, 4, 3, 1, 5, 4, 5, 2}; /* xx, yy, zz, xy, xz, yz */
  const double m = 2.0;
  fb_real r[3], psi[6], theta[6];
  double I[9];
  fbt_seed(17);
  fbt_fill(r, 3, 1.0);
  fbt_fill(psi, 6, 1.0);
  fbt_fill(theta, 6, 1.0);
  FBT_INT_EQ(fb_shape_init(&shape, 2), FB_OK);
  FBT_INT_EQ(fb_shape_add_lump(&shape, (fb_real)m, r, inertia, psi, theta), FB_OK);
  for (int ij = 0; ij < 9; ij++) {
    const double square = ij % 4 == 0 ? (double)fb_vec3_dot(r, r) : 0.0;
    I[ij] = (double)inertia[packed[ij]];
    FBT_NEAR_ABS(shape.J[ij], I[ij] + m * (square - (double)(r[ij / 3] * r[ij % 3])), FBT_TOL(1e-14, 1e-5));
  }
  for (int a = 0; a < 2; a++) {
    const fb_real *t = theta + 3 * a;
    fb_real arm[3];
    fb_vec3_cross(arm, r, psi + 3 * a);
    for (int i = 0; i < 3; i++) {
      const double turned = I[3 * i] * (double)t[0] + I[3 * i + 1] * (double)t[1] + I[3 * i + 2] * (double)t[2];
      FBT_NEAR_ABS(shape.H[3 * a + i], m * (double)arm[i] + turned, FBT_TOL(1e-14, 1e-5));
    }
    for (int b = 0; b < 2; b++) {
      double M = m * (double)fb_vec3_dot(psi + 3 * a, psi + 3 * b);
      for (int ij = 0; ij < 9; ij++) {
        M += (double)t[ij / 3] * I[ij] * (double)theta[3 * b + ij % 3];
      }
      FBT_NEAR_ABS(shape.M[2 * a + b], M, FBT_TOL(1e-14, 1e-5));
    }
  }
}

/* Interface: a beam's coordinates may stand anywhere among those of the body. */
TEST(a_beam_may_take_later_coordinates)
{
  int node[2], at;
  fb_gauge gauge[2];
  fb_real q[BOOM_MODES + 3];
  boom(&shape, node);
  FBT_INT_EQ(fb_shape_init(&other, BOOM_MODES), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&other, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, BOOM_MODES + 3), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 3, &beam, &modes), FB_OK);
  FBT_TRUE(shape_difference(&shape, &other, 3) == 0.0);
  FBT_INT_EQ(fb_shape_add_beam_node(&other, &at, 0, &beam, &modes, FB_R(1.7)), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &at, 3, &beam, &modes, FB_R(1.7)), FB_OK);
  FBT_TRUE(fbt_difference(shape.node[1].psi + 9, other.node[1].psi, 3 * BOOM_MODES) == 0.0);
  FBT_TRUE(fbt_difference(shape.node[1].theta + 9, other.node[1].theta, 3 * BOOM_MODES) == 0.0);
  for (int a = 0, pair = 0; a < BOOM_MODES; a++) {
    for (int b = 0; b <= a; b++, pair += 3) {
      const int later = 3 * ((a + 3) * (a + 4) / 2 + b + 3);
      FBT_TRUE(fbt_difference(shape.node[1].chi + later, other.node[1].chi + pair, 3) == 0.0);
      FBT_TRUE(fbt_difference(shape.node[1].chi_theta + later, other.node[1].chi_theta + pair, 3) == 0.0);
    }
  }
  FBT_INT_EQ(fb_gauge_init(&gauge[0], 0, &beam, &modes, FB_R(1.7), FB_R(0.1), FB_R(0.2)), FB_OK);
  FBT_INT_EQ(fb_gauge_init(&gauge[1], 3, &beam, &modes, FB_R(1.7), FB_R(0.1), FB_R(0.2)), FB_OK);
  fbt_fill(q, BOOM_MODES + 3, 1.0);
  FBT_NEAR_ABS(fb_gauge_eval(&gauge[1], q), fb_gauge_eval(&gauge[0], q + 3), FBT_TOL(1e-14, 1e-5));
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0x7FFFFFFF, &beam, &modes), FB_ERR_CAPACITY);
}

/* ---- as many coordinates, nodes and loads as there can be */

/* x M^-1 y^T of two sets of n rows of three (x: element of row a at x + step a). */
static void inertial_product(double out[9], const fb_real *x, int x_step, const fb_real *y, int y_step,
                             const fb_shape *in)
{
  static fb_real L[FB_MAX_MODES * FB_MAX_MODES], column[FB_MAX_MODES], solved[FB_MAX_MODES];
  memcpy(L, in->M, sizeof(fb_real) * (size_t)(in->n * in->n));
  FBT_INT_EQ(fb_chol_factor(L, in->n), FB_OK);
  for (int j = 0; j < 3; j++) {
    for (int a = 0; a < in->n; a++) {
      column[a] = y[a * y_step + j];
    }
    fb_chol_solve(solved, L, column, in->n);
    for (int i = 0; i < 3; i++) {
      out[3 * i + j] = 0.0;
      for (int a = 0; a < in->n; a++) {
        out[3 * i + j] += (double)x[a * x_step + i] * (double)solved[a];
      }
    }
  }
}

static void skew(double out[9], const fb_real *v, double sign)
{
  const double x = sign * (double)v[0], y = sign * (double)v[1], z = sign * (double)v[2];
  const double m[9] = {0, -z, y, z, 0, -x, -y, x, 0};
  memcpy(out, m, sizeof m);
}

static double largest_difference(const double *a, const double *b)
{
  double largest = 0.0;
  for (int i = 0; i < 9; i++) {
    largest = fmax(largest, fabs(a[i] - b[i]));
  }
  return largest;
}

/* E8.1: [DB] (41), ups_ab = -ups_ba, ups_ab^ = Pi_ab - Pi_ba, h_a^ = Gam_a - Gam_a^T, hold for the boom to rounding. */
TEST(shape_integrals_obey_the_vector_identities)
{
  int node[2];
  boom(&shape, node);
  for (int a = 0; a < BOOM_MODES; a++) {
    double h[9], gam[9];
    skew(h, shape.H + 3 * a, 1.0);
    for (int i = 0; i < 9; i++) {
      gam[i] = (double)shape.second.Gam[9 * a + i] - (double)shape.second.Gam[9 * a + 3 * (i % 3) + i / 3];
    }
    FBT_BELOW(largest_difference(h, gam), FBT_TOL(1e-13, 1e-4));
    for (int b = 0; b < BOOM_MODES; b++) {
      const fb_real *ups = shape.second.ups + 3 * (a * BOOM_MODES + b),
                    *back = shape.second.ups + 3 * (b * BOOM_MODES + a);
      double u[9], minus[9], pi_ab[9];
      skew(u, ups, 1.0);
      skew(minus, back, -1.0);
      for (int i = 0; i < 9; i++) {
        pi_ab[i] = (double)shape.second.Pi[9 * (a * BOOM_MODES + b) + i] -
                   (double)shape.second.Pi[9 * (b * BOOM_MODES + a) + i];
      }
      FBT_BELOW(largest_difference(u, minus), FBT_TOL(1e-15, 1e-6));
      FBT_BELOW(largest_difference(u, pi_ab), FBT_TOL(1e-14, 1e-5));
    }
  }
}

/* E8.1, E6.7: the inertial identities [DB] (46) with N cubic elements, p07_identities.csv: defects of P M^-1 P^T = m, H
   M^-1 P^T = c^, H M^-1 H^T = J, and, closed basis (C), of the three with Upsilon, which hold for every N. With natural
   modes the sums (43) rise with every mode, from the first bending mode on, and stay below. */
TEST(inertial_identities_hold_as_published)
{
  const fbt_table *table = fbt_reference("p07_identities.csv");
  int rows = 0;
  for (int row = 0; row < table->rows; row++) {
    static fb_modes_desc keep;
    const int closed = fbt_word(table, row, "basis")[0] == 'C', N = (int)fbt_value(table, row, "N");
    double d[9];
    if (N > 4) {
      continue;
    }
    memset(&beam_desc, 0, sizeof beam_desc);
    memset(&keep, 0, sizeof keep);
    beam_desc.length = FB_R(10.0);
    beam_desc.n_element = N;
    beam_desc.n_station = 1;
    beam_desc.station[0].mass = FB_R(1.2);
    beam_desc.station[0].EI_z = beam_desc.station[0].EA = FB_R(1e4);
    keep.basis = FB_BASIS_FUNCTIONS;
    keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_AXIAL] = 2 * N;
    keep.root_strain = !closed;
    FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
    FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
    inertial_product(d, shape.P, 3, shape.P, 3, &shape);
    FBT_NEAR_ABS(1.0 - d[0] / 12.0, fbt_value(table, row, "PMP_x"), FBT_TOL(2e-6, 1e-4));
    FBT_NEAR_ABS(1.0 - d[4] / 12.0, fbt_value(table, row, "PMP_y"), FBT_TOL(2e-6, 1e-4));
    inertial_product(d, shape.H, 3, shape.P, 3, &shape);
    FBT_NEAR_ABS(1.0 - d[7] / 60.0, fbt_value(table, row, "HMP"), FBT_TOL(2e-6, 1e-4));
    inertial_product(d, shape.H, 3, shape.H, 3, &shape);
    FBT_NEAR_ABS(1.0 - d[8] / 400.0, fbt_value(table, row, "HMH"), FBT_TOL(2e-6, 1e-4));
    for (int b = 0; b < shape.n && closed; b++) {
      double expected[9];
      inertial_product(d, shape.second.ups + 3 * b * shape.n, 3, shape.P, 3, &shape);
      skew(expected, shape.P + 3 * b, -1.0);
      for (int i = 0; i < 9; i++) { /* in the plane: about z */
        FBT_NEAR_ABS(i >= 6 ? d[i] - expected[i] : 0.0, 0.0, FBT_TOL(1e-12, 1e-4));
      }
    }
    rows++;
  }
  FBT_INT_EQ(rows, 8);
  {
    double before[3] = {0.0, 0.0, 0.0};
    for (int n = 1; n <= 4; n++) {
      static fb_modes_desc keep;
      double d[9];
      memset(&keep, 0, sizeof keep);
      for (int kind = 0; kind < FB_KIND_COUNT; kind++) {
        keep.count[kind] = n;
      }
      beam_desc.n_element = 6;
      beam_desc.station[0].EI_y = beam_desc.station[0].GJ = FB_R(1e4);
      beam_desc.station[0].i_y = beam_desc.station[0].i_z = FB_R(0.01);
      FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
      FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
      FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
      FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
      for (int k = 0; k < 3; k++) {
        double now;
        inertial_product(d,
                         k == 2 ? shape.second.ups
                         : k    ? shape.H
                                : shape.P,
                         3,
                         k == 2 ? shape.second.ups
                         : k    ? shape.H
                                : shape.P,
                         3, &shape);
        now = k == 0   ? (d[0] + d[4] + d[8]) / 36.0
              : k == 1 ? (d[0] + d[4] + d[8]) / (double)(shape.J[0] + shape.J[4] + shape.J[8])
                       : (d[0] + d[4] + d[8]) / (double)(shape.second.Pi[0] + shape.second.Pi[4] + shape.second.Pi[8]);
        FBT_TRUE(now > before[k] && now < 1.0);
        before[k] = now;
      }
    }
    FBT_BELOW(0.85, before[0]);
    FBT_BELOW(0.95, before[1]);
  }
}

/* E6.3, E6.6, E8.1: Hopkins' beam element (C.1, C.2 with ERRATA.md; p09_beam_element.csv): stiffness, geometric
   stiffness, consistent mass with rotary inertia, and the first- and second-order integrals of its six coordinates (q1,
   q2 axial, q3, q4 transverse, q5, q6 rotation): mass center P, inertia I1 = int (r.P) 1 - r P and I2 = int (P_i.P_j) 1
   - P_i P_j, moments O1 = int r x P and O2 = int P_i x P_j. */
TEST(hopkins_element_has_the_exact_integrals)
{
  static const int place[7] = {0, 0, 3, 1, 4, 2, 5}; /* of q1 .. q6 among u_x, u_y, theta_z of both ends */
  const fbt_table *table = fbt_reference("p09_beam_element.csv");
  static fb_modes_desc keep;
  static fb_modes pulled;
  const double l = 2.0, h = 0.2, EA = 3.0, EI = 7.0;
  double largest = 0.0;
  int rows = 0;
  memset(&beam_desc, 0, sizeof beam_desc);
  memset(&keep, 0, sizeof keep);
  beam_desc.length = (fb_real)l;
  beam_desc.n_element = 1;
  beam_desc.root = FB_ROOT_FREE;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = (fb_real)(1.0 / l);
  beam_desc.station[0].i_z = (fb_real)(h * h / 12.0 / l);
  beam_desc.station[0].EA = (fb_real)EA;
  beam_desc.station[0].EI_z = (fb_real)EI;
  keep.basis = FB_BASIS_ELEMENTS;
  keep.count[FB_KIND_AXIAL] = keep.count[FB_KIND_BEND_Y] = 1;
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  keep.preload.force = FB_R(1.0);
  FBT_INT_EQ(fb_modes_solve(&pulled, &modes_work, &beam, &keep), FB_OK);
  keep.preload.force = FB_R(0.0);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(modes.n, 6);
  FBT_INT_EQ(fb_shape_init(&shape, 6), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  for (int row = 0; row < table->rows; row++) {
    const char *kind = fbt_word(table, row, "kind"), *comp = fbt_word(table, row, "comp");
    const int index = (int)fbt_value(table, row, "index");
    const int i1 = index > 10 ? index / 10 : index, i2 = index > 10 ? index % 10 : 0;
    const int a = place[i1 % 7], b2 = place[i2 % 7];
    const int ab = a * 6 + b2, ba = b2 * 6 + a, i = comp[0] - 'x', j = comp[1] ? comp[1] - 'x' : i;
    const double value = fbt_value(table, row, "value_l2_h02");
    double got;
    if (strcmp(kind, "K") == 0) {
      got = (double)modes.K[ab] / (comp[1] == 'A' ? EA : EI);
    } else if (strcmp(kind, "KG") == 0) {
      got = (double)(pulled.K[ab] - modes.K[ab]);
    } else if (strcmp(kind, "M") == 0) {
      got = (double)modes.M[ab];
    } else if (strcmp(kind, "P") == 0) {
      got = (double)shape.P[3 * a + i];
    } else if (strcmp(kind, "I1") == 0) {
      got = (double)shape.second.Gam[9 * a + 3 * i + j];
    } else if (strcmp(kind, "O1") == 0) {
      got = (double)shape.H[3 * a + i];
    } else if (strcmp(kind, "I2") == 0) {
      got = (double)shape.second.Pi[9 * ba + 3 * i + j];
    } else {
      got = -(double)shape.second.ups[3 * ab + i];
    }
    FBT_NEAR_ABS(got, value, FBT_TOL(2e-12, 2e-6) * (1.0 + fabs(value))); /* the file has 12 digits */
    largest = fmax(largest, fabs(got - value));
    rows++;
  }
  FBT_INT_EQ(rows, table->rows);
  FBT_TRUE(rows > 200);
  fbt_figure("beam element: K, KG, M, inertia and moments", "[H] C.1, C.2 (p09)", largest);
}

/* E8.31: a cantilever with a force F at the tip: strain F (L - x) y/EI in element coordinates, exactly. */
TEST(a_strain_gauge_reads_the_bending_moment)
{
  static fb_modes_desc keep;
  static fb_real K[FB_MAX_MODES * FB_MAX_MODES];
  static const double x[] = {0.0, 0.7, 1.3, 2.0};
  fb_real q[FB_MAX_MODES], f[FB_MAX_MODES];
  fb_gauge gauge;
  int node;
  memset(&beam_desc, 0, sizeof beam_desc);
  beam_desc.length = FB_R(2.0);
  beam_desc.n_element = 3;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = FB_R(1.0);
  beam_desc.station[0].EI_y = FB_R(5.0);
  beam_desc.station[0].EI_z = FB_R(4.0);
  memset(&keep, 0, sizeof keep);
  keep.basis = FB_BASIS_ELEMENTS;
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 1;
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, FB_R(2.0)), FB_OK);
  FBT_NEAR_REL(shape.size, 2.0, FBT_TOL(1e-14, 1e-6)); /* out to the tip */
  for (int a = 0; a < modes.n; a++) {
    const fb_real *const tip = shape.node[node].psi + 3 * a;
    FBT_TRUE((double)shape.second.reach[a] >= (1.0 - FBT_TOL(1e-14, 1e-6)) * sqrt((double)fb_vec3_dot(tip, tip)));
    f[a] = FB_R(0.3) * shape.node[node].psi[3 * a + 1] + FB_R(0.2) * shape.node[node].psi[3 * a + 2];
  }
  memcpy(K, modes.K, sizeof K);
  FBT_INT_EQ(fb_chol_factor(K, modes.n), FB_OK);
  fb_chol_solve(q, K, f, modes.n);
  for (int k = 0; k < 4; k++) {
    const double strain = -(0.05 * 0.3 / 4.0 + 0.03 * 0.2 / 5.0) * (2.0 - x[k]);
    FBT_INT_EQ(fb_gauge_init(&gauge, 0, &beam, &modes, (fb_real)x[k], FB_R(0.05), FB_R(0.03)), FB_OK);
    FBT_NEAR_ABS(fb_gauge_eval(&gauge, q), strain, FBT_TOL(1e-14, 1e-6));
  }
  FBT_INT_EQ(fb_gauge_init(&gauge, 0, &beam, &modes, FB_R(2.1), 0, 0), FB_ERR_VALUE);
}

SUITE(body_integrals, RUN(lumps_have_the_inertia_of_their_node), RUN(a_strain_gauge_reads_the_bending_moment),
      RUN(hopkins_element_has_the_exact_integrals), RUN(shape_integrals_obey_the_vector_identities),
      RUN(inertial_identities_hold_as_published), RUN(residual_inertia_vanishes_on_a_rotation_closed_basis),
      RUN(functions_close_the_basis), RUN(beam_integrals_reproduce_mass_and_modal_mass),
      RUN(beam_integrals_hold_for_any_section_and_line), RUN(quadratic_field_is_inextensible_and_twist_free),
      RUN(quadratic_field_follows_a_bent_line_in_any_attitude), RUN(offset_masses_move_with_their_section),
      RUN(lumped_bodies_are_the_particles_they_stand_for), RUN(a_beam_may_take_later_coordinates))
