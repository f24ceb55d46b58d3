/* advise.h - booms, envelopes of what acts on them, shared by the tests of >>advise: what a scene calls
   for: against statics, complex modes, the exact beam, a search that is looked at, and a scene that is simulated. */
#ifndef FBT_ADVISE_H
#define FBT_ADVISE_H

#include "fbt.h"

static fb_shape shape;
static fb_advice_work work;
static fb_envelope envelope;
static fb_body_desc level;
static fb_advice advice;
static fb_real metre = FB_R(1.0), kilogram = FB_R(1.0), second = FB_R(1.0); /* of booms */
static fb_real boom_attitude[4] = {FB_R(1.0), FB_R(0.0), FB_R(0.0), FB_R(0.0)};
static fb_real boom_output = FB_R(1.0); /* part of the length */
static int boom_points;                 /* line_points; 0: the default */

/* A uniform cantilever of 3 m with bending modes along y and z and a node, at the tip; its modes go to `modes`. */
static inline void make_boom(fb_shape *out, fb_modes *modes, int along_y, int along_z)
{
  static fb_beam_desc desc;
  static fb_beam beam;
  static fb_modes_work modes_work;
  static fb_modes_desc keep;
  int node = 0;
  memset(&keep, 0, sizeof keep);
  desc.length = FB_R(3.0) * metre;
  memcpy(desc.attitude, boom_attitude, sizeof desc.attitude);
  desc.n_element = 6;
  desc.n_station = 1;
  desc.station[0].mass = FB_R(2.0) * kilogram / metre;
  desc.station[0].EI_y = FB_R(500.0) * kilogram * metre * metre * metre / (second * second);
  desc.station[0].EI_z = FB_R(900.0) * kilogram * metre * metre * metre / (second * second);
  keep.count[FB_KIND_BEND_Y] = along_y;
  keep.count[FB_KIND_BEND_Z] = along_z;
  keep.line_points = boom_points;
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(out, modes->n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(out, 0, &beam, modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(out, &node, 0, &beam, modes, boom_output * desc.length), FB_OK);
  FBT_INT_EQ(node, 1);
}

/* Every test begins with a held boom on which a force [N] along z acts at the tip. */
static inline void boom_under_a_force(double force, int along_y, int along_z)
{
  static fb_modes modes;
  make_boom(&shape, &modes, along_y, along_z);
  memset(&level, 0, sizeof level);
  level.effects = FB_EFFECTS_FULL;
  level.base = FB_BASE_PRESCRIBED;
  memset(&envelope, 0, sizeof envelope);
  envelope.node = 1;
  envelope.duration = FB_R(10.0);
  envelope.n_load = 1;
  envelope.load[0].node = 1;
  envelope.load[0].axes = FB_AXES_BODY;
  envelope.load[0].force[2] = (fb_real)force;
}

/* A hub of 100 kg with two equal booms of 5 m, along x and -x, that flies: the modes of one boom after those of the
   other, y before z; the tips are nodes 1, which is the output, and 2. */
static inline void make_two_booms(int along_y, int along_z)
{
  static fb_modes modes;
  static fb_beam beam;
  static fb_modes_work modes_work;
  static fb_beam_desc desc;
  const fb_real inertia[6] = {20, 20, 20, 0, 0, 0}, origin[3] = {0, 0, 0};
  const int n = along_y + along_z;
  fb_modes_desc keep;
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Y] = along_y;
  keep.count[FB_KIND_BEND_Z] = along_z;
  FBT_INT_EQ(fb_shape_init(&shape, 2 * n), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(100.0), origin, inertia), FB_OK);
  for (int k = 0; k < 2; k++) {
    int node = 0;
    memset(&desc, 0, sizeof desc);
    desc.length = FB_R(5.0);
    desc.attitude[3 * k] = FB_R(1.0); /* the second after half a turn about z */
    desc.n_element = 10;
    desc.n_station = 1;
    desc.station[0].mass = FB_R(0.5);
    desc.station[0].EI_y = desc.station[0].EI_z = FB_R(500.0);
    FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam(&shape, n * k, &beam, &modes), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, n * k, &beam, &modes, desc.length), FB_OK);
    FBT_INT_EQ(node, k + 1);
  }
  memset(&level, 0, sizeof level);
  level.effects = FB_EFFECTS_FULL;
  memset(&envelope, 0, sizeof envelope);
  envelope.node = 1;
  envelope.duration = FB_R(10.0);
  envelope.n_load = 1;
  envelope.load[0].axes = FB_AXES_BODY;
}

/* Advice for the envelope must succeed; returns its deflection. */
static inline double deflection(void)
{
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_OK);
  return (double)advice.deflection;
}

/* All modes and effects in short steps of rk4, for the scene of a candidate. */
static inline fb_advice all_of(const fb_advice *candidate)
{
  fb_advice all = *candidate;
  all.effects = FB_EFFECTS_FULL;
  all.integrator = FB_INTEGRATOR_RK4;
  all.n = shape.n;
  all.dt = FB_R(0.005);
  for (int a = 0; a < all.n; a++) {
    all.coordinate[a] = a;
  }
  return all;
}

#endif
