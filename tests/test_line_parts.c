/* >>line: bodies of several lines beside imported components with polynomial terms. */
#include "fbt.h"

#include <math.h>
#include <string.h>

enum { BOOM = 5, PARTS = 2 * BOOM + 2 }; /* two booms of five modes and an imported component of two */

static fb_body body, other;
static fb_body_work body_work;
static fb_shape shape;

/* A boom along its x axis with offset masses, torsion and a tip body. */
static void boom_add(int first, const fb_real position[3], const fb_real attitude[4])
{
  static fb_beam_desc desc;
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work work;
  fb_modes_desc keep;
  int node;
  memset(&desc, 0, sizeof desc);
  memset(&keep, 0, sizeof keep);
  desc.length = FB_R(4.0);
  desc.n_element = 8;
  desc.n_station = 1;
  desc.station[0].mass = FB_R(0.8);
  desc.station[0].EI_y = FB_R(300.0);
  desc.station[0].EI_z = FB_R(500.0);
  desc.station[0].GJ = FB_R(200.0);
  desc.station[0].i_y = FB_R(0.01);
  desc.station[0].i_z = FB_R(0.02);
  desc.station[0].mass_z = FB_R(0.02);
  desc.n_lump = 1;
  desc.lump[0].node = 8;
  desc.lump[0].mass = FB_R(1.5);
  desc.lump[0].center[1] = FB_R(0.1);
  desc.lump[0].inertia[0] = desc.lump[0].inertia[1] = desc.lump[0].inertia[2] = FB_R(0.05);
  memcpy(desc.position, position, sizeof desc.position);
  memcpy(desc.attitude, attitude, sizeof desc.attitude);
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 2;
  keep.count[FB_KIND_TORSION] = 1;
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &work, &beam, &keep), FB_OK);
  FBT_INT_EQ(modes.n, BOOM);
  FBT_INT_EQ(fb_shape_add_beam(&shape, first, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, first, &beam, &modes, FB_R(2.3)), FB_OK);
}

/* Particles that move with the coordinates first .. first + count - 1, by displacements of first and second degree. */
static void particles_add(int first, int count)
{
  fb_real psi[3 * PARTS], chi[3 * PARTS * PARTS];
  for (int k = 0; k < 4; k++) {
    const fb_real r[3] = {(fb_real)cos(k), (fb_real)sin(k), (fb_real)(0.3 * k)};
    memset(psi, 0, sizeof psi);
    memset(chi, 0, sizeof chi);
    for (int a = first; a < first + count; a++) {
      for (int i = 0; i < 3; i++) {
        psi[3 * a + i] = (fb_real)(0.3 * sin((1.0 + a) * (1.0 + i + 1.7 * k)));
        for (int b = first; b < first + count; b++) {
          chi[3 * (a * shape.n + b) + i] = (fb_real)(0.1 * cos(a + b + i + k));
        }
      }
    }
    FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(2.0), r, psi, chi), FB_OK);
  }
}

/* Hub, two booms, an imported component of two coordinates. */
static void parts_make(fb_base base)
{
  const fb_real center[3] = {FB_R(0.1), FB_R(0.0), FB_R(-0.1)};
  const fb_real inertia[6] = {FB_R(8.0), FB_R(9.0), FB_R(10.0), FB_R(0.5), FB_R(0.0), FB_R(0.2)};
  const fb_real at[2][3] = {{FB_R(0.5), FB_R(0.2), FB_R(0.0)}, {FB_R(-0.5), FB_R(0.0), FB_R(0.3)}};
  const fb_real turn[2][4] = {{FB_R(0.0)}, {FB_R(0.3), FB_R(0.1), FB_R(0.2), FB_R(0.9)}};
  fb_body_desc desc;
  FBT_INT_EQ(fb_shape_init(&shape, PARTS), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(20.0), center, inertia), FB_OK);
  boom_add(0, at[0], turn[0]);
  boom_add(BOOM, at[1], turn[1]);
  particles_add(2 * BOOM, 2);
  shape.K[(PARTS - 2) * (PARTS + 1)] += FB_R(50.0);
  shape.K[(PARTS - 1) * (PARTS + 1)] += FB_R(80.0);
  memset(&desc, 0, sizeof desc);
  desc.base = base;
  desc.effects = FB_EFFECTS_LARGE | FB_EFFECT_GRAVITY;
  desc.gravity[1] = -FB_R(2.0);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  desc.effects = FB_EFFECTS_FULL | FB_EFFECT_GRAVITY;
  FBT_INT_EQ(fb_body_init(&other, &body_work, &shape, &desc), FB_OK);
}

/* A state of large deflection at the identity attitude, momenta as the base allows. */
static void state_make(fb_state *state, double size)
{
  FBT_INT_EQ(fb_state_init(&body, state), FB_OK);
  for (int a = 0; a < body.n; a++) {
    state->q[a] = (fb_real)(size * (a < 2 * BOOM ? 0.9 : 0.15) * sin(1.0 + 1.7 * a) / (1 + a % BOOM));
    state->pi[a] = (fb_real)(size * 0.5 * cos(2.0 * a));
  }
  for (int i = 0; i < 3 && body.base != FB_BASE_PRESCRIBED; i++) {
    state->L[i] = (fb_real)(size * (body.base == FB_BASE_HINGED && i < 2 ? 0.0 : 4.0 - 3.0 * i));
  }
}

static double energy_of(const fb_state *state)
{
  fb_energy energy;
  FBT_INT_EQ(fb_body_energy_eval(&body, &energy, state, NULL), FB_OK);
  return (double)energy.kinetic + (double)energy.strain + (double)energy.gravity;
}

/* E14.12, E14.13: Hamilton's equations: q_dot = dH/dpi, pi_dot = -dH/dq at fixed momenta, for every base and with every
   kind of part. On a free base gravity is left out: it acts on rho. */
TEST(rates_of_mixed_bodies_are_hamiltonian)
{
  for (int k = 0; k < (FB_SINGLE ? 0 : (int)FB_BASE_COUNT); k++) { /* differences want double precision */
    fb_state state, rate;
    double size_q = 0.0, size_pi = 0.0, error_q = 0.0, error_pi = 0.0;
    parts_make((fb_base)k);
    if (body.base == FB_BASE_FREE) {
      memset(body.gravity, 0, sizeof body.gravity);
    }
    state_make(&state, 1.0);
    FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, NULL), FB_OK);
    for (int a = 0; a < body.n; a++) {
      const double h = 1e-5;
      double by_q = 0.0, by_pi = 0.0;
      for (int side = -1; side <= 1; side += 2) {
        fb_state moved = state;
        moved.q[a] += (fb_real)(side * h);
        by_q -= side * energy_of(&moved) / (2.0 * h);
        moved = state;
        moved.pi[a] += (fb_real)(side * h);
        by_pi += side * energy_of(&moved) / (2.0 * h);
      }
      error_q = fmax(error_q, fabs((double)rate.q[a] - by_pi));
      error_pi = fmax(error_pi, fabs((double)rate.pi[a] - by_q));
      size_q = fmax(size_q, fabs(by_pi));
      size_pi = fmax(size_pi, fabs(by_q));
    }
    FBT_BELOW(error_q, 1e-7 * size_q);
    FBT_BELOW(error_pi, 1e-7 * size_pi);
  }
}

/* E14.16: accelerations of body, coordinates and nodes are the derivatives of the velocities along a run. */
TEST(accelerations_of_mixed_bodies_are_derivatives)
{
  for (int k = 0; k < (FB_SINGLE ? 0 : (int)FB_BASE_COUNT); k++) {
    static fb_rk4_work work;
    const double h = 1e-4;
    fb_state state;
    fb_input input;
    fb_motion motion[3];
    fb_node_motion node[3];
    memset(&input, 0, sizeof input);
    input.n_load = 1;
    input.load[0].node = 2;
    input.load[0].axes = FB_AXES_NODE;
    input.load[0].force[1] = FB_R(3.0);
    input.load[0].torque[0] = FB_R(0.5);
    parts_make((fb_base)k);
    body.allow_long_step = 1;
    state_make(&state, 1.0);
    for (int i = 0; i < 3; i++) {
      FBT_INT_EQ(fb_body_motion_eval(&body, &motion[i], &state, &input), FB_OK);
      FBT_INT_EQ(fb_body_node_motion_eval(&body, &node[i], &state, &motion[i], 1), FB_OK);
      FBT_INT_EQ(fb_rk4_step(&body, &state, &work, &input, &input, &input, (fb_real)h), FB_OK);
    }
    for (int a = 0; a < body.n; a++) {
      FBT_NEAR_ABS(motion[1].q_ddot[a], (double)(motion[2].q_dot[a] - motion[0].q_dot[a]) / (2 * h), 0.02);
    }
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(motion[1].w_dot[i], (double)(motion[2].w[i] - motion[0].w[i]) / (2 * h), 1e-3);
      FBT_NEAR_ABS(node[1].velocity[i], (double)(node[2].position[i] - node[0].position[i]) / (2 * h), 1e-5);
      FBT_NEAR_ABS(node[1].acceleration[i], (double)(node[2].velocity[i] - node[0].velocity[i]) / (2 * h), 5e-3);
      FBT_NEAR_ABS(node[1].angular_acceleration[i],
                   (double)(node[2].angular_rate[i] - node[0].angular_rate[i]) / (2 * h), 2e-2);
    }
  }
}

/* E14.12, E14.13: without beams the effect changes nothing: M, Lambda and M_rr of the terms, Schur complement at every
   evaluation, are the polynomial S(q). */
TEST(without_beams_the_effect_changes_nothing)
{
  const fb_real center[3] = {FB_R(0.1), FB_R(0.0), FB_R(-0.1)};
  const fb_real inertia[6] = {FB_R(8.0), FB_R(9.0), FB_R(10.0), FB_R(0.5), FB_R(0.0), FB_R(0.2)};
  for (int k = 0; k < (int)FB_BASE_COUNT; k++) {
    fb_body_desc desc;
    fb_state state, rate, expected;
    fb_motion motion, wanted;
    memset(&desc, 0, sizeof desc);
    desc.base = (fb_base)k;
    desc.effects = FB_EFFECTS_LARGE;
    FBT_INT_EQ(fb_shape_init(&shape, 4), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(20.0), center, inertia), FB_OK);
    particles_add(0, 4);
    for (int a = 0; a < 4; a++) {
      shape.K[5 * a] = FB_R(50.0);
    }
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
    desc.effects = FB_EFFECTS_FULL;
    FBT_INT_EQ(fb_body_init(&other, &body_work, &shape, &desc), FB_OK);
    state_make(&state, 0.3);
    FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, NULL), FB_OK);
    FBT_INT_EQ(fb_body_rates_eval(&other, &expected, &state, NULL), FB_OK);
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, NULL), FB_OK);
    FBT_INT_EQ(fb_body_motion_eval(&other, &wanted, &state, NULL), FB_OK);
    for (int a = 0; a < 4; a++) {
      FBT_NEAR_ABS(rate.q[a], expected.q[a], FBT_TOL(1e-13, 1e-5));
      FBT_NEAR_ABS(rate.pi[a], expected.pi[a], FBT_TOL(1e-12, 1e-4));
      FBT_NEAR_ABS(motion.q_ddot[a], wanted.q_ddot[a], FBT_TOL(1e-11, 1e-3));
    }
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(motion.w[i], wanted.w[i], FBT_TOL(1e-13, 1e-5));
      FBT_NEAR_ABS(motion.w_dot[i], wanted.w_dot[i], FBT_TOL(1e-12, 1e-4));
      FBT_NEAR_ABS(motion.acceleration[i], wanted.acceleration[i], FBT_TOL(1e-12, 1e-4));
    }
  }
}

/* E14.12: at a thousandth of the deflection the mixed body is the polynomial one: what differs is of third degree. */
TEST(mixed_bodies_tie_to_polynomial_ones)
{
  const double size = FBT_TOL(1e-4, 1e-2);
  fb_state state, rate, expected;
  parts_make(FB_BASE_FREE);
  state_make(&state, size);
  FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, NULL), FB_OK);
  FBT_INT_EQ(fb_body_rates_eval(&other, &expected, &state, NULL), FB_OK);
  for (int a = 0; a < body.n; a++) {
    FBT_NEAR_ABS(rate.q[a], expected.q[a], FBT_TOL(1e-3, 1e-2) * size);
    FBT_NEAR_ABS(rate.pi[a], expected.pi[a], FBT_TOL(1e-2, 1e-1) * size);
  }
}

/* Status of the body with large deflection, 0, and without it, 1. */
static fb_status parts_again(int polynomial)
{
  fb_body_desc desc;
  memset(&desc, 0, sizeof desc);
  desc.effects = polynomial ? FB_EFFECTS_FULL : FB_EFFECTS_LARGE;
  return fb_body_init(polynomial ? &other : &body, &body_work, &shape, &desc);
}

/* Interface: what moves with modes of a beam by shapes that the caller gives would stay on its polynomial while the
   beam bends far. It is refused; on coordinates that are not of a beam it is not. */
TEST(parts_that_shapes_move_with_a_line_are_refused)
{
  const fb_real r[3] = {FB_R(1.0), FB_R(0.5), FB_R(0.0)}, inertia[6] = {FB_R(0.1), FB_R(0.1), FB_R(0.1)};
  fb_real psi[3 * PARTS], theta[3 * PARTS], none[3 * PARTS];
  memset(none, 0, sizeof none);
  for (int kind = 0; kind < 6; kind++) {
    for (int on = 0; on < 2; on++) { /* the imported component, the second boom */
      const int a = on ? BOOM + 2 : PARTS - 1;
      int node = 0;
      parts_make(FB_BASE_FREE);
      memset(psi, 0, sizeof psi);
      memset(theta, 0, sizeof theta);
      psi[3 * a] = theta[3 * a + 1] = FB_R(0.4);
      switch (kind) {
      case 0:
        FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(0.1), r, psi, NULL), FB_OK);
        break;
      case 1:
        FBT_INT_EQ(fb_shape_add_lump(&shape, FB_R(0.1), r, NULL, psi, theta), FB_OK);
        break;
      case 2: /* turns with it alone */
        FBT_INT_EQ(fb_shape_add_lump(&shape, FB_R(0.1), r, inertia, none, theta), FB_OK);
        break;
      case 3:
        FBT_INT_EQ(fb_shape_add_node(&shape, &node, r, psi, none), FB_OK);
        break;
      case 4:
        FBT_INT_EQ(fb_shape_add_node(&shape, &node, r, none, theta), FB_OK);
        break;
      default:
        FBT_INT_EQ(fb_shape_add_pair(&shape, a, PARTS - 1, psi + 3 * a, NULL, NULL), FB_OK);
      }
      FBT_INT_EQ(parts_again(0), on ? FB_ERR_EFFECTS : FB_OK);
      FBT_INT_EQ(parts_again(1), FB_OK);
    }
  }
}

SUITE(line_parts, RUN(parts_that_shapes_move_with_a_line_are_refused), RUN(rates_of_mixed_bodies_are_hamiltonian),
      RUN(accelerations_of_mixed_bodies_are_derivatives), RUN(without_beams_the_effect_changes_nothing),
      RUN(mixed_bodies_tie_to_polynomial_ones))
