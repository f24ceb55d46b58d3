/* >>assemble: a body from one description is the body of the chain. */
#include "fbt.h"

#include <math.h>
#include <string.h>

static fb_build_desc desc;
static fb_build_work work;
static fb_beam_desc boom;
static fb_modes_desc keep;
static fb_body body;

/* A hub with a boom along x and one along -x, which starts half a meter off and is turned about z. */
static void two_booms(void)
{
  memset(&desc, 0, sizeof desc);
  memset(&boom, 0, sizeof boom);
  memset(&keep, 0, sizeof keep);
  boom.length = FB_R(5.0);
  boom.n_element = 8;
  boom.n_station = 1;
  boom.station[0].mass = FB_R(0.5);
  boom.station[0].EI_y = boom.station[0].EI_z = FB_R(400.0);
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 2;
  desc.mass = FB_R(300.0);
  desc.inertia[0] = desc.inertia[1] = FB_R(60.0);
  desc.inertia[2] = FB_R(80.0);
  desc.n_part = 2;
  for (int side = 0; side < 2; side++) {
    fb_part *const part = &desc.part[side];
    part->position[0] = side ? -FB_R(0.5) : FB_R(0.5);
    part->attitude[side ? 3 : 0] = FB_R(1.0);
    part->n_node = 1;
    part->node[0] = boom.length;
  }
  desc.zeta = FB_R(0.005);
  desc.body.effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING;
}

/* Interface: the same bits as the chain of calls, nodes and damping included. */
TEST(one_description_is_the_chain)
{
  static fb_body chain;
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_shape shape;
  static fb_body_work body_work;
  fb_body_desc level;
  two_booms();
  FBT_INT_EQ(fb_body_build(&body, &work, &desc, &boom, &keep, 1), FB_OK);
  FBT_INT_EQ(body.n, 8);
  FBT_INT_EQ(body.n_node, 3);
  FBT_INT_EQ(fb_shape_init(&shape, 8), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, desc.mass, desc.center, desc.inertia), FB_OK);
  for (int side = 0; side < 2; side++) {
    int tip;
    memcpy(boom.position, desc.part[side].position, sizeof boom.position);
    memcpy(boom.attitude, desc.part[side].attitude, sizeof boom.attitude);
    FBT_INT_EQ(fb_beam_init(&beam, &boom), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam(&shape, 4 * side, &beam, &modes), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &tip, 4 * side, &beam, &modes, boom.length), FB_OK);
    FBT_INT_EQ(tip, 1 + side);
  }
  level = desc.body;
  for (int k = 0; k < 8; k++) {
    level.zeta[k] = desc.zeta;
  }
  FBT_INT_EQ(fb_body_init(&chain, &body_work, &shape, &level), FB_OK);
  FBT_TRUE(fb_body_crc(&chain) == fb_body_crc(&body));
}

/* A body whose description has these factors, into `body`; held: on a prescribed base. */
static void described(const fb_body_factors *by, int held)
{
  two_booms();
  desc.mass *= by->hub_mass;
  desc.center[0] = FB_R(0.1);
  for (int i = 0; i < 6; i++) {
    desc.inertia[i] *= by->hub_inertia;
  }
  boom.station[0].mass *= by->mass;
  boom.station[0].EI_y *= by->stiffness;
  boom.station[0].EI_z = FB_R(0.7) * boom.station[0].EI_y;
  desc.zeta *= by->damping;
  desc.body.base = held ? FB_BASE_PRESCRIBED : FB_BASE_FREE;
  desc.body.effects |= FB_EFFECT_GRAVITY;
  desc.body.gravity[1] = -FB_R(0.7);
  desc.body.mu = FB_R(900.0); /* a center as near as the tips: the pull on the hub and on the booms differs */
  desc.body.center[0] = FB_R(14.0);
  desc.body.center[2] = -FB_R(9.0);
  FBT_INT_EQ(fb_body_build(&body, &work, &desc, &boom, &keep, 1), FB_OK);
}

/* The body without factors, scaled by them; of a hub that is told. */
static void scaled(fb_body *out, const fb_body_factors *by, int held)
{
  const fb_body_factors one = {FB_R(1.0), FB_R(1.0), FB_R(1.0),   FB_R(1.0),
                               FB_R(1.0), FB_R(0.0), {FB_R(0.0)}, {FB_R(0.0)}};
  fb_body_factors own = *by;
  described(&one, held);
  own.hub = desc.mass;
  memcpy(own.center, desc.center, sizeof own.center);
  memcpy(own.inertia, desc.inertia, sizeof own.inertia);
  FBT_INT_EQ(fb_body_scale(out, &work.scratch.body, &body, &own), FB_OK);
}

/* E8.61: rates, in uniform gravity and that of a center, energy and step limit of a scaled body are those of the one whose description has the factors. Its modes are
   normalized by other masses: q and pi have other units. */
TEST(a_scaled_body_moves_as_the_one_described)
{
  static fb_body other;
  for (int k = 0; k < 3; k++) {
    const fb_body_factors by = {k == 1 ? FB_R(1.0) : FB_R(4.0),
                                k == 1 ? FB_R(1.0) : FB_R(0.6),
                                k == 1 ? FB_R(1.0) : FB_R(0.25),
                                k == 2 ? FB_R(0.25) : FB_R(0.8),
                                k == 2 ? FB_R(0.25) : FB_R(1.3),
                                FB_R(0.0),
                                {FB_R(0.0)},
                                {FB_R(0.0)}};
    const fb_real unit = (fb_real)sqrt((double)by.mass), v[3] = {FB_R(0.3), FB_R(-0.2), FB_R(0.1)};
    const fb_real w[3] = {FB_R(0.2), FB_R(0.5), FB_R(-0.4)}, tol = (fb_real)FBT_TOL(1e-12, 1e-4);
    fb_real rates[8], q_dot[8];
    fb_state one, two, rate_one, rate_two;
    fb_energy energy_one, energy_two;
    scaled(&other, &by, 0);
    described(&by, 0);
    FBT_NEAR_REL(other.mass, body.mass, tol);
    FBT_NEAR_REL(other.recoil, body.recoil, tol);
    FBT_NEAR_REL(other.gyration, body.gyration, tol);
    FBT_INT_EQ(fb_state_init(&body, &one), FB_OK);
    FBT_INT_EQ(fb_state_init(&other, &two), FB_OK);
    for (int a = 0; a < 8; a++) {
      two.q[a] = FB_R(0.01) * (fb_real)(a % 3 - 1);
      one.q[a] = unit * two.q[a];
      rates[a] = FB_R(0.1) * (fb_real)(a % 5 - 2);
      q_dot[a] = unit * rates[a];
    }
    FBT_INT_EQ(fb_state_from_velocity(&body, &one, v, w, q_dot), FB_OK);
    FBT_INT_EQ(fb_state_from_velocity(&other, &two, v, w, rates), FB_OK);
    FBT_INT_EQ(fb_body_rates_eval(&body, &rate_one, &one, NULL), FB_OK);
    FBT_INT_EQ(fb_body_rates_eval(&other, &rate_two, &two, NULL), FB_OK);
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(two.L[i], one.L[i], tol * FB_R(100.0));
      FBT_NEAR_ABS(rate_two.rho[i], rate_one.rho[i], tol);
      FBT_NEAR_ABS(rate_two.u[i], rate_one.u[i], tol * FB_R(10.0));
      FBT_NEAR_ABS(rate_two.L[i], rate_one.L[i], tol * FB_R(100.0));
    }
    for (int a = 0; a < 8; a++) {
      FBT_NEAR_ABS(unit * rate_two.q[a], rate_one.q[a], tol * FB_R(1.0));
      FBT_NEAR_ABS(rate_two.pi[a], unit * rate_one.pi[a], tol * FB_R(100.0));
    }
    FBT_INT_EQ(fb_body_energy_eval(&body, &energy_one, &one, NULL), FB_OK);
    FBT_INT_EQ(fb_body_energy_eval(&other, &energy_two, &two, NULL), FB_OK);
    FBT_NEAR_REL(energy_two.kinetic, energy_one.kinetic, tol);
    FBT_NEAR_REL(energy_two.strain, energy_one.strain, tol);
    FBT_NEAR_REL(energy_two.gravity, energy_one.gravity, tol);
    FBT_NEAR_REL(fb_rk4_limit(&other, FB_R(0.0), FB_R(0.0)), fb_rk4_limit(&body, FB_R(0.0), FB_R(0.0)), tol);
    FBT_TRUE(fb_rk4_limit(&other, FB_R(9.0), FB_R(9.0)) <
             (FB_R(1.0) + tol) * fb_rk4_limit(&body, FB_R(9.0), FB_R(9.0)));
  }
}

/* E8.61: of a held body omega^2 = k/m, whose bound E8.8 is exact at rest, and the damping 2 zeta omega. */
TEST(frequencies_scale_by_the_root_of_stiffness_over_mass)
{
  static fb_body other;
  const fb_body_factors by = {FB_R(3.0), FB_R(0.5), FB_R(1.7),   FB_R(1.0),
                              FB_R(1.0), FB_R(0.0), {FB_R(0.0)}, {FB_R(0.0)}};
  scaled(&other, &by, 1);
  for (int a = 0; a < body.n; a++) {
    const fb_real square = body.K.diagonal[a] / body.M.diagonal[a];
    FBT_NEAR_REL(other.K.diagonal[a] / other.M.diagonal[a], square * by.stiffness / by.mass, FBT_TOL(1e-14, 1e-6));
    FBT_NEAR_REL(other.C.diagonal[a] / other.M.diagonal[a],
                 2.0 * (double)(desc.zeta * by.damping) * sqrt((double)(square * by.stiffness / by.mass)),
                 FBT_TOL(1e-13, 1e-5));
  }
  FBT_NEAR_REL(other.limit_elastic, body.limit_elastic * by.stiffness / by.mass, FBT_TOL(1e-14, 1e-6));
}

/* Interface: factors 1 leave the bits, others that there cannot be are refused and leave the body. */
TEST(factors_that_there_cannot_be_are_refused)
{
  static fb_body other, before;
  const fb_body_factors one = {FB_R(1.0), FB_R(1.0), FB_R(1.0),   FB_R(1.0),
                               FB_R(1.0), FB_R(0.0), {FB_R(0.0)}, {FB_R(0.0)}};
  fb_body_work *const room = &work.scratch.body;
  fb_body_factors by = one;
  described(&one, 0);
  FBT_INT_EQ(fb_body_scale(&other, room, &body, &one), FB_OK);
  FBT_TRUE(fb_body_crc(&other) == fb_body_crc(&body));
  before = other;
  by.stiffness = FB_R(0.0);
  FBT_INT_EQ(fb_body_scale(&other, room, &body, &by), FB_ERR_VALUE);
  by = one;
  by.damping = -FB_R(1.0);
  FBT_INT_EQ(fb_body_scale(&other, room, &body, &by), FB_ERR_VALUE);
  by = one;
  by.mass = (fb_real)NAN;
  FBT_INT_EQ(fb_body_scale(&other, room, &body, &by), FB_ERR_NOT_FINITE);
  by = one;
  by.hub_mass = FB_R(2.0); /* of no hub */
  FBT_INT_EQ(fb_body_scale(&other, room, &body, &by), FB_ERR_VALUE);
  by.hub = FB_R(2.0) * body.mass;
  FBT_INT_EQ(fb_body_scale(&other, room, &body, &by), FB_ERR_VALUE);
  by.hub = desc.mass;
  by.hub_inertia = FB_R(0.01); /* of more inertia than the body has */
  by.inertia[0] = by.inertia[1] = by.inertia[2] = FB_R(1e4);
  FBT_INT_EQ(fb_body_scale(&other, room, &body, &by), FB_ERR_SINGULAR);
  FBT_TRUE(fb_body_crc(&other) == fb_body_crc(&before));
  other.effects |= FB_EFFECT_ROTORS;
  by = one;
  by.mass = FB_R(2.0);
  FBT_INT_EQ(fb_body_scale(&before, room, &other, &by), FB_ERR_UNSUPPORTED);
  FBT_INT_EQ(fb_body_scale(NULL, room, &body, &one), FB_ERR_NULL);
}

/* E7.9: a boom whose tip is its boundary: the same bits as the chain, and the tip's node moves with its own
   coordinates, by their unit. */
TEST(a_component_is_the_chain)
{
  static fb_body chain;
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_shape shape;
  static fb_body_work body_work;
  static const int axis[4] = {1, 2, 4, 5};
  int tip;
  two_booms();
  keep.basis = FB_BASIS_COMPONENT;
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 1;
  keep.n_boundary = 4;
  for (int k = 0; k < 4; k++) {
    keep.boundary[k].node = boom.n_element;
    keep.boundary[k].axis = axis[k];
  }
  desc.n_part = 1;
  desc.zeta = FB_R(0.0);
  desc.body.effects = FB_EFFECTS_FULL;
  FBT_INT_EQ(fb_body_build(&body, &work, &desc, &boom, &keep, 1), FB_OK);
  FBT_INT_EQ(body.n, 6);
  for (int k = 0; k < 4; k++) {
    const fb_real *const moved = axis[k] < 3 ? body.node[1].psi : body.node[1].theta;
    for (int a = 0; a < 6; a++) {
      FBT_NEAR_ABS(moved[3 * a + axis[k] % 3], a == k ? 1.0 : 0.0, FBT_TOL(1e-12, 1e-4));
    }
  }

  memcpy(boom.position, desc.part[0].position, sizeof boom.position);
  FBT_INT_EQ(fb_beam_init(&beam, &boom), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, 6), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, desc.mass, desc.center, desc.inertia), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &tip, 0, &beam, &modes, boom.length), FB_OK);
  FBT_INT_EQ(fb_body_init(&chain, &body_work, &shape, &desc.body), FB_OK);
  FBT_TRUE(fb_body_crc(&chain) == fb_body_crc(&body));
}

static fb_beam_desc tube[2];
static fb_modes_desc component[2];

/* A hub with a mast of 2 m along x and an arm of 3 m on its tip, turned by `angle` about z: both components, with the
   place where they meet for boundary. */
static void mast_and_arm(double angle)
{
  two_booms();
  memset(component, 0, sizeof component);
  boom.station[0].EA = FB_R(1e5);
  boom.station[0].GJ = FB_R(300.0);
  boom.station[0].i_y = boom.station[0].i_z = FB_R(0.01);
  for (int k = 0; k < 2; k++) {
    tube[k] = boom;
    tube[k].length = k ? FB_R(3.0) : FB_R(2.0);
    tube[k].n_element = k ? 6 : 4;
    tube[k].root = k ? FB_ROOT_FREE : FB_ROOT_CLAMPED;
    component[k].basis = FB_BASIS_COMPONENT;
    component[k].count[FB_KIND_BEND_Y] = component[k].count[FB_KIND_BEND_Z] = 2;
    component[k].count[FB_KIND_TORSION] = 1;
    component[k].n_boundary = 6;
    for (int i = 0; i < 6; i++) {
      component[k].boundary[i].node = k ? 0 : tube[0].n_element;
      component[k].boundary[i].axis = i;
    }
    desc.part[k].beam = k;
    desc.part[k].node[0] = tube[k].length;
  }
  desc.part[1].position[0] = desc.part[0].position[0] + tube[0].length;
  desc.part[1].attitude[0] = (fb_real)cos(0.5 * angle);
  desc.part[1].attitude[3] = (fb_real)sin(0.5 * angle);
  desc.join.n_weld = 1;
  desc.join.weld[0].component[1] = 1;
  desc.join.weld[0].node[0] = tube[0].n_element;
  desc.join.lowest = 6;
}

/* Interface: the same bits as the chain with fb_modes_join, at an angle. */
TEST(joined_parts_are_the_chain)
{
  static fb_body chain;
  static fb_beam beam[2];
  static fb_modes basis[2], joined[2];
  static fb_modes_work modes_work;
  static fb_join_work join_work;
  static fb_shape shape;
  static fb_body_work body_work;
  fb_body_desc level;
  mast_and_arm(1.0);
  FBT_INT_EQ(fb_body_build(&body, &work, &desc, tube, component, 2), FB_OK);
  FBT_INT_EQ(body.n, 6);
  FBT_INT_EQ(body.n_node, 3);
  for (int k = 0; k < 2; k++) {
    memcpy(tube[k].position, desc.part[k].position, sizeof tube[k].position);
    memcpy(tube[k].attitude, desc.part[k].attitude, sizeof tube[k].attitude);
    FBT_INT_EQ(fb_beam_init(&beam[k], &tube[k]), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&basis[k], &modes_work, &beam[k], &component[k]), FB_OK);
  }
  FBT_INT_EQ(fb_modes_join(joined, &join_work, beam, basis, &desc.join, 2), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, 6), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, desc.mass, desc.center, desc.inertia), FB_OK);
  for (int k = 0; k < 2; k++) {
    int tip;
    FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam[k], &joined[k]), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &tip, 0, &beam[k], &joined[k], tube[k].length), FB_OK);
  }
  level = desc.body;
  for (int k = 0; k < 6; k++) {
    level.zeta[k] = desc.zeta;
  }
  FBT_INT_EQ(fb_body_init(&chain, &body_work, &shape, &level), FB_OK);
  FBT_TRUE(fb_body_crc(&chain) == fb_body_crc(&body));
}

/* E7.12: mast and arm in one line are a boom of 5 m that was never cut: two pairs of bending modes, torsion, a third
   pair. */
TEST(joined_parts_are_the_uncut_beam)
{
  static fb_body whole;
  double omega[6];
  mast_and_arm(0.0);
  FBT_INT_EQ(fb_body_build(&body, &work, &desc, tube, component, 2), FB_OK);
  for (int k = 0; k < 6; k++) {
    omega[k] = (double)work.modes[1].omega[k];
  }
  memset(&desc.join, 0, sizeof desc.join);
  memset(keep.count, 0, sizeof keep.count);
  keep.lowest = 6;
  desc.n_part = 1;
  FBT_INT_EQ(fb_body_build(&whole, &work, &desc, &boom, &keep, 1), FB_OK);
  for (int k = 0; k < 6; k++) {
    FBT_NEAR_REL(omega[k], work.modes[0].omega[k], 2e-3);
  }
  FBT_NEAR_REL(body.mass, whole.mass, FBT_TOL(1e-14, 1e-6));
}

/* Interface: without a weld, what is joined are the modes of all parts, sorted by frequency: of two equal booms the
   lowest pairs. */
TEST(parts_may_share_a_count_of_modes)
{
  two_booms();
  desc.join.lowest = 4;
  FBT_INT_EQ(fb_body_build(&body, &work, &desc, &boom, &keep, 1), FB_OK);
  FBT_INT_EQ(body.n, 4);
  FBT_NEAR_REL(work.modes[0].omega[3], work.modes[0].omega[0], FBT_TOL(1e-9, 1e-4));
}

/* E4.1: the place of a part and that of its beam's description follow each other: a beam a meter along z of its
   description, on a part that is turned by 90 degrees about x, lies a meter along -y. */
TEST(parts_carry_the_place_of_their_beam)
{
  two_booms();
  desc.n_part = 1;
  boom.position[2] = FB_R(1.0);
  memset(desc.part[0].attitude, 0, sizeof desc.part[0].attitude);
  desc.part[0].attitude[0] = desc.part[0].attitude[1] = FB_R(0.70710678118654752);
  FBT_INT_EQ(fb_body_build(&body, &work, &desc, &boom, &keep, 1), FB_OK);
  FBT_NEAR_ABS(body.node[1].r[0], 5.5, FBT_TOL(1e-12, 1e-5));
  FBT_NEAR_ABS(body.node[1].r[1], -1.0, FBT_TOL(1e-12, 1e-5));
  FBT_NEAR_ABS(body.node[1].r[2], 0.0, FBT_TOL(1e-12, 1e-5));
}

/* Interface: without beams the hub is a rigid body; without a hub the beam alone is one that its base carries. */
TEST(parts_may_be_missing)
{
  two_booms();
  desc.n_part = 0;
  memset(desc.part, 0, sizeof desc.part);
  desc.zeta = FB_R(0.0);
  desc.body.effects = FB_EFFECTS_RIGID;
  FBT_INT_EQ(fb_body_build(&body, &work, &desc, NULL, NULL, 0), FB_OK);
  FBT_INT_EQ(body.n, 0);
  FBT_NEAR_REL(body.mass, 300.0, FBT_TOL(1e-15, 1e-7));
  two_booms();
  desc.mass = FB_R(0.0);
  memset(desc.inertia, 0, sizeof desc.inertia);
  desc.body.base = FB_BASE_PRESCRIBED;
  FBT_INT_EQ(fb_body_build(&body, &work, &desc, &boom, &keep, 1), FB_OK);
  FBT_NEAR_REL(body.mass, 5.0, FBT_TOL(1e-12, 1e-6));
}

/* Interface: a failure tells the part and leaves the body alone. */
TEST(the_part_at_fault_is_told)
{
  static fb_body before;
  two_booms();
  memset(&body, 255, sizeof body);
  before = body;
  desc.part[1].beam = 1;
  FBT_INT_EQ(fb_body_build(&body, &work, &desc, &boom, &keep, 1), FB_ERR_CAPACITY);
  FBT_INT_EQ(work.part, 1);
  two_booms();
  desc.part[1].node[0] = FB_R(5.1); /* beyond the tip */
  FBT_TRUE(fb_body_build(&body, &work, &desc, &boom, &keep, 1) != FB_OK);
  FBT_INT_EQ(work.part, 1);
  two_booms();
  desc.mass = -FB_R(1.0);
  FBT_INT_EQ(fb_body_build(&body, &work, &desc, &boom, &keep, 1), FB_ERR_VALUE);
  FBT_INT_EQ(work.part, -1);
  two_booms();
  desc.body.zeta[0] = FB_R(0.01); /* and zeta */
  FBT_INT_EQ(fb_body_build(&body, &work, &desc, &boom, &keep, 1), FB_ERR_VALUE);
  FBT_INT_EQ(work.part, 2);
  two_booms();
  desc.n_part = FB_MAX_PARTS + 1;
  FBT_INT_EQ(fb_body_build(&body, &work, &desc, &boom, &keep, 1), FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_body_build(&body, &work, NULL, &boom, &keep, 1), FB_ERR_NULL);
  for (int what = 0; what < 3; what++) { /* what is no number is not nothing */
    two_booms();
    memset(desc.inertia, 0, sizeof desc.inertia);
    memset(desc.part[0].attitude, 0, sizeof desc.part[0].attitude);
    *(what == 0 ? &desc.mass : what == 1 ? &desc.part[0].attitude[0] : &desc.zeta) = (fb_real)NAN;
    FBT_INT_EQ(fb_body_build(&body, &work, &desc, &boom, &keep, 1), FB_ERR_NOT_FINITE);
    FBT_INT_EQ(work.part, what - 1 + (what == 2));
  }
  two_booms();
  desc.n_part = 3; /* more coordinates than there may be */
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = FB_MAX_MODES / 4;
  FBT_INT_EQ(fb_body_build(&body, &work, &desc, &boom, &keep, 1), FB_ERR_CAPACITY);
  FBT_INT_EQ(work.part, 2);
  FBT_TRUE(memcmp(&body, &before, sizeof body) == 0);
}

/* Interface: joining fails as a whole; a part that hangs on another one wants a node there. */
TEST(parts_that_do_not_meet_are_refused)
{
  static fb_body before;
  memset(&body, 255, sizeof body);
  before = body;
  for (int what = 0; what < 5; what++) {
    mast_and_arm(1.0);
    switch (what) {
    case 0:
      desc.part[1].position[0] += FB_R(0.01);
      break;
    case 1:
      desc.join.weld[0].component[1] = 2; /* no such part */
      break;
    case 2:
      desc.join.n_weld = -1;
      break;
    case 3:
      desc.join.omega_limit = (fb_real)NAN;
      break;
    default:
      desc.part[0].n_node = 0;
      desc.part[0].node[0] = FB_R(0.0);
      break;
    }
    FBT_INT_EQ(fb_body_build(&body, &work, &desc, tube, component, 2), what == 1   ? FB_ERR_CAPACITY
                                                                       : what == 3 ? FB_ERR_NOT_FINITE
                                                                                   : FB_ERR_VALUE);
    FBT_INT_EQ(work.part, what == 4 ? 1 : 2);
  }
  FBT_TRUE(memcmp(&body, &before, sizeof body) == 0);
}

/* Interface: a free root that no weld attaches does not belong to the hub, whose motion would not bend it: refused,
   with the part; a beam that is the whole body may be free, with what it carries. A pinned root beside a hub turns on
   its pin by its rigid-body modes alone: without them it would be locked in the mean. */
TEST(roots_that_nothing_attaches_are_refused)
{
  two_booms();
  boom.root = FB_ROOT_FREE;
  boom.station[0].i_y = boom.station[0].i_z = FB_R(0.01);
  desc.zeta = FB_R(0.0);
  desc.body.effects = FB_EFFECTS_FULL;
  FBT_INT_EQ(fb_body_build(&body, &work, &desc, &boom, &keep, 1), FB_ERR_VALUE);
  FBT_INT_EQ(work.part, 0);
  keep.rigid = 1;
  FBT_INT_EQ(fb_body_build(&body, &work, &desc, &boom, &keep, 1), FB_ERR_VALUE);
  desc.n_part = 1;
  FBT_INT_EQ(fb_body_build(&body, &work, &desc, &boom, &keep, 1), FB_ERR_VALUE);
  keep.rigid = 0;
  boom.root = FB_ROOT_PINNED;
  FBT_INT_EQ(fb_body_build(&body, &work, &desc, &boom, &keep, 1), FB_ERR_VALUE);
  keep.rigid = 1;
  FBT_INT_EQ(fb_body_build(&body, &work, &desc, &boom, &keep, 1), FB_OK);
  keep.rigid = 0;
  desc.mass = FB_R(0.0);
  memset(desc.inertia, 0, sizeof desc.inertia);
  for (int n = 2; n > 0; n--) { /* two that nothing holds together; one that is the body */
    desc.n_part = n;
    boom.root = FB_ROOT_FREE;
    FBT_INT_EQ(fb_body_build(&body, &work, &desc, &boom, &keep, 1), n > 1 ? FB_ERR_VALUE : FB_OK);
  }
}

/* Interface: what is welded must be able to move with its partner: a part that is clamped to the frame, too, or has
   natural modes without its rigid-body motion, would lock the weld; a free one with them does not. */
TEST(welds_that_a_root_would_lock_are_refused)
{
  for (int what = 0; what < 3; what++) {
    mast_and_arm(0.0);
    component[1].basis = FB_BASIS_MODES;
    component[1].n_boundary = 0;
    memset(component[1].boundary, 0, sizeof component[1].boundary);
    component[1].rigid = what > 1;
    tube[1].root = what == 0 ? FB_ROOT_CLAMPED : FB_ROOT_FREE;
    FBT_INT_EQ(fb_body_build(&body, &work, &desc, tube, component, 2), what > 1 ? FB_OK : FB_ERR_VALUE);
    FBT_INT_EQ(work.part, what > 1 ? 2 : 1);
  }
}

SUITE(body_build, RUN(roots_that_nothing_attaches_are_refused), RUN(welds_that_a_root_would_lock_are_refused),
      RUN(one_description_is_the_chain), RUN(a_component_is_the_chain), RUN(joined_parts_are_the_chain),
      RUN(joined_parts_are_the_uncut_beam), RUN(parts_may_share_a_count_of_modes),
      RUN(parts_carry_the_place_of_their_beam), RUN(parts_may_be_missing), RUN(the_part_at_fault_is_told),
      RUN(parts_that_do_not_meet_are_refused), RUN(a_scaled_body_moves_as_the_one_described),
      RUN(frequencies_scale_by_the_root_of_stiffness_over_mass), RUN(factors_that_there_cannot_be_are_refused))
