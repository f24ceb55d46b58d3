/* >>line: what cannot be a line is refused, and what is near a limit of the points is where it belongs. */
#include "fbt.h"

#include <math.h>
#include <string.h>

static fb_beam_desc beam[2];
static fb_modes_desc keep[2];
static fb_build_desc desc;
static fb_build_work work;
static fb_body body;

/* Two booms of 2 m with torsion and stretch, the second one free at its root, to be welded; a hub at O. */
static void booms(void)
{
  memset(beam, 0, sizeof beam);
  memset(keep, 0, sizeof keep);
  memset(&desc, 0, sizeof desc);
  for (int k = 0; k < 2; k++) {
    fb_section *const s = &beam[k].station[0];
    beam[k].length = FB_R(2.0);
    beam[k].n_element = 10;
    beam[k].n_station = 1;
    s->mass = FB_R(1.0);
    s->EI_y = FB_R(20.0);
    s->EI_z = FB_R(30.0);
    s->GJ = FB_R(12.0);
    s->EA = FB_R(1e4);
    s->i_y = s->i_z = FB_R(1e-3);
    keep[k].count[FB_KIND_BEND_Y] = keep[k].count[FB_KIND_BEND_Z] = 2;
    keep[k].line_points = 8;
  }
  beam[1].root = FB_ROOT_FREE;
  keep[1].rigid = 1;
  keep[1].count[FB_KIND_TORSION] = 1;
  desc.mass = FB_R(10.0);
  desc.inertia[0] = desc.inertia[1] = desc.inertia[2] = FB_R(5.0);
  desc.n_part = 1;
  desc.part[0].n_node = 1;
  desc.part[0].node[0] = FB_R(2.0);
  desc.body.effects = FB_EFFECTS_LARGE;
}

/* Welds node a of part `on` to node b of part `part`. */
static void weld_add(int on, int a, int part, int b)
{
  fb_weld *const weld = &desc.join.weld[desc.join.n_weld++];
  weld->component[0] = on;
  weld->node[0] = a;
  weld->component[1] = part;
  weld->node[1] = b;
}

/* Part k of the second boom at (x, y), along y with `side` 1, along -y with -1; a node at its tip. */
static void bar_add(int k, double x, double y, int side)
{
  fb_part *const part = &desc.part[k];
  part->beam = 1;
  part->position[0] = (fb_real)x;
  part->position[1] = (fb_real)y;
  part->attitude[0] = FB_R(0.70710678118654752);
  part->attitude[3] = (fb_real)(side * 0.70710678118654752);
  part->n_node = 1;
  part->node[0] = FB_R(2.0);
  desc.n_part = k + 1;
}

static fb_status build(void)
{
  return fb_body_build(&body, &work, &desc, beam, keep, 2);
}

/* Interface: a node that moves with a beam by its shapes alone would stay on the polynomial while the line bends. */
TEST(nodes_beside_their_line_are_refused)
{
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_beam one;
  static fb_shape shape;
  static fb_body_work body_work;
  const fb_real center[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)}, place[3] = {FB_R(2.0), FB_R(0.0), FB_R(0.0)};
  for (int imported = 0; imported < 2; imported++) {
    fb_real psi[3 * FB_MAX_MODES], still[3 * FB_MAX_MODES];
    fb_body_desc plain;
    int node;
    booms();
    memset(psi, 0, sizeof psi);
    memset(still, 0, sizeof still);
    psi[1] = FB_R(1.0);
    plain = desc.body;
    plain.effects = FB_EFFECTS_FULL;
    FBT_INT_EQ(fb_beam_init(&one, &beam[0]), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &one, &keep[0]), FB_OK);
    FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(10.0), center, desc.inertia), FB_OK);
    if (!imported) {
      FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &one, &modes, FB_R(2.0)), FB_OK);
    }
    FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &one, &modes), FB_OK);
    if (imported) {
      FBT_INT_EQ(fb_shape_add_node(&shape, &node, place, psi, psi), FB_OK);
    }
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc.body), FB_ERR_EFFECTS);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &plain), FB_OK);

    /* one that does not move, and one added in time */
    FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(10.0), center, desc.inertia), FB_OK);
    FBT_INT_EQ(fb_shape_add_node(&shape, &node, place, still, still), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &one, &modes), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &one, &modes, FB_R(2.0)), FB_OK);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc.body), FB_OK);
  }
}

/* Interface: common modes close a loop to first degree alone: bent lines would part at the weld. Trees of welds do not,
   nor do welds that repeat others. */
TEST(welds_that_close_a_loop_are_refused)
{
  booms(); /* two clamped booms side by side, a bar across from tip to tip */
  desc.n_part = 2;
  desc.part[1].position[1] = FB_R(2.0);
  bar_add(2, 2.0, 0.0, 1);
  weld_add(0, 10, 2, 0);
  weld_add(1, 10, 2, 10);
  desc.join.lowest = 4;
  FBT_INT_EQ(build(), FB_ERR_UNSUPPORTED);
  desc.body.effects = FB_EFFECTS_FULL;
  FBT_INT_EQ(build(), FB_OK);

  booms(); /* a T, each pair of its three ends welded, one twice */
  bar_add(1, 2.0, 0.0, 1);
  bar_add(2, 2.0, 0.0, -1);
  weld_add(0, 10, 1, 0);
  weld_add(2, 0, 0, 10);
  weld_add(1, 0, 2, 0);
  weld_add(1, 0, 0, 10);
  desc.join.lowest = 6;
  FBT_INT_EQ(build(), FB_OK);
  FBT_INT_EQ(body.lines.n_line, 3);
  FBT_INT_EQ(body.lines.line[1].hangs, body.lines.line[2].hangs);
}

/* E14.4, E14.5, E7.12: in the middle of a smooth line is no point to hang on; a lumped body of no mass makes one. */
TEST(lines_hang_on_points)
{
  for (int lump = 0; lump < 2; lump++) {
    fb_node_motion on, root;
    fb_motion rest;
    fb_state state;
    booms();
    memset(&rest, 0, sizeof rest);
    beam[0].n_lump = lump;
    beam[0].lump[0].node = 7;
    desc.part[0].node[0] = FB_R(1.4);
    bar_add(1, 1.4, 0.0, 1);
    desc.part[1].node[0] = FB_R(0.0);
    weld_add(0, 7, 1, 0);
    desc.join.lowest = 4;
    FBT_INT_EQ(build(), lump ? FB_OK : FB_ERR_KIND);
    if (lump) { /* both sides of the weld, where the lines bend far */
      FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
      for (int a = 0; a < body.n; a++) {
        const fb_real *const t = body.node[1].theta + 3 * a;
        state.q[a] = (fb_real)(0.3 / sqrt((double)fb_vec3_dot(t, t)));
      }
      FBT_INT_EQ(fb_body_node_motion_eval(&body, &on, &state, &rest, 1), FB_OK);
      FBT_INT_EQ(fb_body_node_motion_eval(&body, &root, &state, &rest, 2), FB_OK);
      FBT_TRUE((double)fb_vec3_dot(on.displacement, on.displacement) > 0.01);
      for (int i = 0; i < 3; i++) {
        FBT_NEAR_ABS(on.position[i], (double)root.position[i], FBT_TOL(1e-12, 1e-5));
        FBT_NEAR_ABS(on.rotation[i], (double)root.rotation[i], FBT_TOL(1e-12, 1e-5));
      }
    }
    desc.body.effects = FB_EFFECTS_FULL;
    FBT_INT_EQ(build(), FB_OK);
  }
}

/* Interface: a line is found by its place: of two beams in one place with the same coordinates neither is. Bent lines
   from one root are told from each other by their tips. */
TEST(lines_in_one_place_are_refused)
{
  booms();
  bar_add(1, 2.0, 0.0, 1);
  bar_add(2, 2.0, 0.0, 1);
  weld_add(0, 10, 1, 0);
  weld_add(0, 10, 2, 0);
  desc.join.lowest = 6;
  FBT_INT_EQ(build(), FB_ERR_UNSUPPORTED);
  desc.body.effects = FB_EFFECTS_FULL;
  FBT_INT_EQ(build(), FB_OK);

  booms(); /* two beams of their own coordinates may be in one place */
  desc.n_part = 2;
  desc.part[1].n_node = 1;
  desc.part[1].node[0] = FB_R(2.0);
  FBT_INT_EQ(build(), FB_OK);
  FBT_INT_EQ(body.node[1].line.line, 1);
  FBT_INT_EQ(body.node[2].line.line, 2);
}

/* Interface: K under a preload is no stiffness of curvatures: a line that bends takes the load along. */
TEST(lines_have_no_preload)
{
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_beam one;
  booms();
  keep[0].preload.force = FB_R(3.0);
  FBT_INT_EQ(build(), FB_ERR_UNSUPPORTED);
  desc.body.effects = FB_EFFECTS_FULL;
  FBT_INT_EQ(build(), FB_OK);

  booms();
  FBT_INT_EQ(fb_beam_init(&one, &beam[0]), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &one, &keep[0]), FB_OK);
  FBT_INT_EQ(modes.line_points, 8);
  keep[0].preload.force = FB_R(-3.0);
  FBT_INT_EQ(fb_buckling_solve(&modes, &modes_work, &one, &keep[0]), FB_OK);
  FBT_INT_EQ(modes.line_points, 0);

  booms();
  keep[0].line_points = 1;
  FBT_INT_EQ(build(), FB_ERR_VALUE);
  keep[0].line_points = FB_MAX_POINTS + 1;
  FBT_INT_EQ(build(), FB_ERR_VALUE);
}

/* E14.11: a heavy body on a node close to an end of a stretch moves with the line: the first moment of mass is that body's
   at the node's place, wherever the node is. */
TEST(lumped_bodies_near_the_tip_move_with_the_line)
{
  const double gap[3] = {0.3, 0.01, 0.0005}; /* [m] from the tip; short elements are too stiff for single precision */
  const double heavy = 1e3, g = 10.0;
  for (int k = 0; k < (FB_SINGLE ? 1 : 3); k++) {
    fb_state state;
    fb_node_motion at;
    fb_motion rest;
    fb_energy energy;
    booms();
    memset(&rest, 0, sizeof rest);
    beam[0].n_element = 4;
    beam[0].n_point = 5;
    beam[0].point[1][0] = FB_R(0.5);
    beam[0].point[2][0] = FB_R(1.0);
    beam[0].point[3][0] = (fb_real)(2.0 - gap[k]);
    beam[0].point[4][0] = FB_R(2.0);
    beam[0].n_lump = 1;
    beam[0].lump[0].node = 3;
    beam[0].lump[0].mass = (fb_real)heavy;
    keep[0].count[FB_KIND_BEND_Y] = keep[0].count[FB_KIND_BEND_Z] = 1;
    desc.part[0].node[0] = (fb_real)(2.0 - gap[k]);
    desc.body.effects = FB_EFFECTS_LARGE | FB_EFFECT_GRAVITY;
    desc.body.gravity[1] = (fb_real)-g;
    FBT_INT_EQ(build(), FB_OK);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    for (int a = 0; a < body.n; a++) { /* 0.7 rad at that node, some of it in each plane */
      state.q[a] = (fb_real)(0.5 / hypot((double)body.node[1].theta[3 * a + 1], (double)body.node[1].theta[3 * a + 2]));
    }
    FBT_INT_EQ(fb_body_node_motion_eval(&body, &at, &state, &rest, 1), FB_OK);
    FBT_INT_EQ(fb_body_energy_eval(&body, &energy, &state, NULL), FB_OK);
    FBT_TRUE(fabs((double)at.displacement[1]) > 0.3);
    FBT_NEAR_REL(energy.gravity, heavy * g * (double)at.displacement[1], 3e-3); /* the beam itself: 1e-3 */
  }
}

/* E14.11: three points do not see where the mass of a long taper is. */
TEST(masses_that_points_miss_are_refused)
{
  for (int points = 2; points <= 8; points += 6) {
    booms();
    beam[0].n_station = 3;
    for (int k = 1; k < 3; k++) {
      beam[0].station[k] = beam[0].station[0];
      beam[0].station[k].x = FB_R(1.6) + FB_R(0.4) * (fb_real)(k - 1);
      beam[0].station[k].mass = k == 1 ? FB_R(1.0) : FB_R(30.0);
    }
    keep[0].line_points = points;
    FBT_INT_EQ(build(), points == 2 ? FB_ERR_VALUE : FB_OK);
    desc.body.effects = FB_EFFECTS_FULL;
    FBT_INT_EQ(build(), FB_OK);
  }
}

/* E8.40: axes and root of a line are read where its points are looked at. */
TEST(the_check_word_sees_where_lines_begin)
{
  unsigned whole;
  booms();
  FBT_INT_EQ(build(), FB_OK);
  whole = fb_body_crc(&body);
  for (int i = 0; i < 12; i++) {
    fb_real *const x = i < 9 ? &body.lines.line[0].axes[i] : &body.lines.line[0].root[i - 9];
    const fb_real was = *x;
    *x += FB_R(1.0);
    FBT_TRUE(fb_body_crc(&body) != whole);
    *x = (fb_real)NAN;
    FBT_INT_EQ(fb_body_check(&body), FB_ERR_VALUE);
    *x = was;
  }
  FBT_INT_EQ(fb_body_check(&body), FB_OK);
}

/* Interface: a node of a line lies at its root or behind one of its own points. */
TEST(nodes_beyond_their_line_are_refused)
{
  fb_line_node *node;
  booms();
  FBT_INT_EQ(build(), FB_OK);
  node = &body.node[body.n_node - 1].line;
  for (int after = -1; after <= 12; after++) {
    node->after = after;
    FBT_INT_EQ(fb_body_check(&body), after >= 0 && after <= body.lines.line[0].count ? FB_OK : FB_ERR_VALUE);
  }
  node->after = 1;
  for (int line = -1; line <= 2; line++) {
    node->line = line;
    FBT_INT_EQ(fb_body_check(&body), line == 0 || line == 1 ? FB_OK : FB_ERR_VALUE);
  }
}

SUITE(line_refusals, RUN(nodes_beyond_their_line_are_refused), RUN(nodes_beside_their_line_are_refused),
      RUN(welds_that_close_a_loop_are_refused), RUN(lines_hang_on_points), RUN(lines_in_one_place_are_refused),
      RUN(lines_have_no_preload), RUN(lumped_bodies_near_the_tip_move_with_the_line),
      RUN(masses_that_points_miss_are_refused), RUN(the_check_word_sees_where_lines_begin))
