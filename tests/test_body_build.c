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

/* The same bits as the chain of calls, nodes and damping included. */
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

/* The place of a part and that of its beam's description follow each other: a beam a meter along z of its description,
   on a part that is turned by 90 degrees about x, lies a meter along -y. */
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

/* Without beams the hub is a rigid body; without a hub the beam alone is one that its base carries. */
TEST(parts_may_be_missing)
{
  two_booms();
  desc.n_part = 0;
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

/* A failure tells the part and leaves the body alone. */
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
  FBT_TRUE(memcmp(&body, &before, sizeof body) == 0);
}

SUITE(body_build, RUN(one_description_is_the_chain), RUN(parts_carry_the_place_of_their_beam),
      RUN(parts_may_be_missing), RUN(the_part_at_fault_is_told))
