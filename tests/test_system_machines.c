/* >>system: machines whose links bend far (FB_EFFECT_LARGE_DEFLECTION) against the same ones cut finer and against
   references of other programs; joints that close loops, constraint rows, joint forces and nodes on lines. */
#include "system.h"

/* ---- against references */

/* E14.1, E9.12, E9.15 on p11: the double pendulum of very flexible links, integrated there with p-elements in inertial
   axes; the links stretch. */
TEST(double_pendulums_of_lines_follow_the_reference)
{
  const fbt_table *table = fbt_reference("p11_double_pendulum.csv");
  double worst = 0.0;
  fresh();
  body_desc.effects = FB_EFFECTS_LARGE | FB_EFFECT_GRAVITY;
  body_desc.gravity[1] = -FB_R(9.81);
  link_beam(&model[0], 1.0, 0.5, 2.0, 2e4, 6, 1, 9.0);
  hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
  hang(1, 0, FB_JOINT_REVOLUTE, 0, 1);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, NULL, NULL), FB_OK);
  for (int row = 1; row < table->rows && fbt_value(table, row, "t") < FBT_LONG(1.51, 0.31); row++) {
    const double T = fbt_value(table, row, "t") - fbt_value(table, row - 1, "t");
    const int n = (int)ceil(T / 2e-4);
    double x[3];
    for (int k = 0; k < n; k++) {
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, (fb_real)(T / n)), FB_OK);
    }
    node_at(x, &state, 1, 1);
    worst = fmax(worst, hypot(x[0] - fbt_value(table, row, "tip_x"), x[1] - fbt_value(table, row, "tip_y")));
    node_at(x, &state, 0, 1);
    worst = fmax(worst, hypot(x[0] - fbt_value(table, row, "hinge_x"), x[1] - fbt_value(table, row, "hinge_y")));
  }
  FBT_BELOW(worst, FBT_TOL(1e-3, 1e-2));
  fbt_figure("double pendulum of links that bend far, tip and hinge to 1.5 s [link lengths]", "p11_double_pendulum.csv",
             worst);
}

/* ---- cut finer */

/* Part of a beam whose tip carries what follows: clamped to the body's frame, modes of a fixed tip and those of each
   motion of the tip (axes y, z, and rotations about them; planar: in the plane). A body at the root: rigid, about z. */
static void part(fb_body *body, const fb_section *section, double length, int bending, int planar, double hub)
{
  static const int axes[5] = {1, 5, 2, 4, 3};
  static fb_modes_desc keep;
  const fb_real root[3] = {0},
                inertia[6] = {(fb_real)(0.05 * hub), (fb_real)(0.05 * hub), (fb_real)(0.05 * hub), 0, 0, 0};
  fb_body_desc d = body_desc;
  int node;
  memset(&keep, 0, sizeof keep);
  memset(&beam_desc, 0, sizeof beam_desc);
  beam_desc.length = (fb_real)length;
  beam_desc.n_element = 8;
  beam_desc.n_station = 1;
  beam_desc.station[0] = *section;
  keep.basis = FB_BASIS_COMPONENT;
  keep.n_boundary = planar ? 2 : 5;
  for (int i = 0; i < keep.n_boundary; i++) {
    keep.boundary[i].node = 8;
    keep.boundary[i].axis = axes[i];
  }
  keep.count[FB_KIND_BEND_Y] = bending;
  keep.count[FB_KIND_BEND_Z] = planar ? 0 : bending;
  keep.count[FB_KIND_TORSION] = planar ? 0 : bending - 1;
  d.base = FB_BASE_PRESCRIBED;
  d.effects |= FB_EFFECTS_LARGE;
  d.deflection_limit = FB_R(99.0);
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)hub, root, inertia), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, (fb_real)length), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, (fb_real)(0.5 * length)), FB_OK);
  FBT_INT_EQ(fb_body_init(body, &body_work, &shape, &d), FB_OK);
}

enum { SAMPLES = 32 };

typedef struct path {
  double x[SAMPLES][2][3]; /* a point that is looked at, and where its link begins */
  double bent;             /* [lengths] most that the link's tip was off its root's tangent */
} path;

/* Largest distance of two paths. */
static double apart(const path *a, const path *b)
{
  double worst = 0.0;
  for (int k = 0; k < SAMPLES; k++) {
    for (int i = 0; i < 2; i++) {
      const double *x = a->x[k][i], *y = b->x[k][i];
      const double d =
          sqrt((x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) + (x[2] - y[2]) * (x[2] - y[2]));
      worst = d > worst || d != d ? d : worst;
    }
  }
  return worst;
}

/* What is off the x axis of the body `first` of a link at node 1 of its last body, in lengths. */
static double off_axis(int first, int last, double length)
{
  fb_node_motion at;
  fb_real R[9], arm[3], own[3];
  FBT_INT_EQ(fb_body_node_motion_eval(&model[desc.model[last]], &at, &motion.pose[last], &motion.motion[last], 1),
             FB_OK);
  for (int i = 0; i < 3; i++) {
    arm[i] = at.position[i] - motion.pose[first].rho[i];
  }
  fb_quat_to_mat33(R, motion.pose[first].quat);
  fb_mat33_mulT_vec3(own, R, arm);
  return hypot((double)own[1], (double)own[2]) / length;
}

/* E14.1, E14.13, E9.15: a boom of four links, folded like a ruler on a free hub, that springs unfold: the path of its
   tip and of its last hinge, by links of one body each and by links of two, each a fourth as far bent. */
static void unfold(path *p, int cut, double T, int steps)
{
  fb_section section;
  const double length = 1.0;
  memset(&section, 0, sizeof section);
  memset(p, 0, sizeof *p);
  section.mass = FB_R(0.5);
  section.EI_z = FB_R(3.0);
  fresh();
  part(&model[0], &section, length / cut, 5 - cut, 1, 20.0);
  part(&model[1], &section, length / cut, 5 - cut, 1, 0.0);
  for (int k = 0; k < 4 * cut; k++) {
    const int link = k / cut, hinge = k % cut == 0;
    fb_joint_desc *j = &desc.joint[k];
    hang(k, k > 0, k == 0 ? FB_JOINT_FREE : hinge ? FB_JOINT_REVOLUTE : FB_JOINT_RIGID, k - 1, k > 0);
    if (k > 0 && hinge) {
      j->stiffness[0] = FB_R(0.8);
      j->damping[0] = FB_R(0.05);
      start[k].value[0] = (fb_real)(link % 2 ? 2.9 : -2.9);
    }
  }
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
  for (int sample = 0; sample < SAMPLES; sample++) {
    for (int k = 0; k < steps; k++) {
      FBT_INT_EQ(
          fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, (fb_real)(T / (SAMPLES * steps))),
          FB_OK);
    }
    node_at(p->x[sample][0], &state, 4 * cut - 1, 1);
    node_at(p->x[sample][1], &state, 3 * cut - 1, 1);
    for (int link = 0; link < 4; link++) {
      p->bent = fmax(p->bent, off_axis(link * cut, link * cut + cut - 1, length));
    }
  }
}

/* E9.25: four links of large deflection move as eight of half their length. */
TEST(folded_booms_unfold_as_finer_ones_do)
{
  static path whole, finer;
  const double T = FBT_LONG(0.9, 0.09);
  unfold(&whole, 1, T, FBT_LONG(120, 20));
  unfold(&finer, 2, T, FBT_LONG(500, 60));
  FBT_TRUE(FBT_SHORT || whole.bent > 0.1);
  FBT_BELOW(apart(&whole, &finer), 4.0 * FBT_TOL(1e-3, 1e-2));
  fbt_figure("boom of four links unfolds, tip to 0.9 s [boom lengths]", "links cut in two",
             apart(&whole, &finer) / 4.0);
}

/* E14.1, E9.12, E9.15: a rotor blade with hinges of flap and lag on a shaft that turns at a constant rate, under gravity
   and a load on its tip, as one body and as four. */
static void turn_rotor(path *p, int cut, double T, int steps)
{
  const double length = 4.0, spin = 4.0;
  fb_section section;
  fb_system_input middle;
  memset(&section, 0, sizeof section);
  memset(p, 0, sizeof *p);
  section.mass = FB_R(1.0);
  section.EI_y = FB_R(60.0);
  section.EI_z = FB_R(200.0);
  section.GJ = FB_R(100.0);
  section.i_y = section.i_z = FB_R(0.01);
  fresh();
  body_desc.effects = FB_EFFECT_GRAVITY;
  body_desc.gravity[2] = -FB_R(9.81);
  rigid(&model[1], 1.0, 0.1, 0, 0, 0.1, 0.1, 0.1);
  rigid(&model[2], 0.0, 0, 0, 0, 0, 0, 0);
  part(&model[0], &section, length / cut, cut > 1 ? 2 : 5, 0, 0.0);
  hang(0, 1, FB_JOINT_REVOLUTE, FB_GROUND, 0);
  hang(1, 2, FB_JOINT_REVOLUTE, 0, 1); /* flap, about -y: z of the joint */
  turn(desc.joint[1].attitude, 0.5 * pi, 0, 0);
  turn(desc.joint[1].child_attitude, 0.5 * pi, 0, 0);
  desc.joint[1].stiffness[0] = FB_R(60.0);
  desc.joint[1].damping[0] = FB_R(4.0);
  hang(2, 0, FB_JOINT_REVOLUTE, 1, 0); /* lag */
  desc.joint[2].stiffness[0] = FB_R(60.0);
  desc.joint[2].damping[0] = FB_R(4.0);
  for (int k = 3; k < 2 + cut; k++) {
    hang(k, 0, FB_JOINT_RIGID, k - 1, 1);
  }
  desc.joint[0].mode[0] = FB_AXIS_PRESCRIBED;
  input.drive[0].rate[0] = start[0].speed[0] = (fb_real)spin;
  input.n_load = 1;
  input.load[0].body = 1 + cut;
  input.load[0].load.node = 1;
  input.load[0].load.axes = FB_AXES_NODE;
  input.load[0].load.force[1] = FB_R(8.0);
  input.load[0].load.force[2] = FB_R(45.0);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  middle = input;
  for (int sample = 0; sample < SAMPLES; sample++) {
    for (int k = 0; k < steps; k++) {
      const double dt = T / (SAMPLES * steps), t = dt * (sample * steps + k);
      fb_system_input end = input;
      input.drive[0].value[0] = (fb_real)(spin * t);
      middle.drive[0].value[0] = (fb_real)(spin * (t + 0.5 * dt));
      end.drive[0].value[0] = (fb_real)(spin * (t + dt));
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &middle, &end, (fb_real)dt), FB_OK);
      input = end;
    }
    node_at(p->x[sample][0], &state, 1 + cut, 1);
    node_at(p->x[sample][1], &state, cut > 1 ? 3 : 2, cut > 1 ? 1 : 2); /* the middle */
    p->bent = fmax(p->bent, off_axis(2, 1 + cut, length));
  }
}

/* E9.25: a blade of large deflection on hinges moves as one of four links. */
TEST(hinged_rotors_turn_as_finer_ones_do)
{
  static path whole, finer;
  const double T = FBT_LONG(1.6, 0.1);
  turn_rotor(&whole, 1, T, FBT_LONG(100, 8));
  turn_rotor(&finer, 4, T, FBT_LONG(200, 15));
  FBT_TRUE(FBT_SHORT || whole.bent > 0.1);
  FBT_BELOW(apart(&whole, &finer), 4.0 * FBT_TOL(1e-3, 1e-2));
  fbt_figure("rotor with flap and lag hinges, one turn [blade lengths]", "blade cut in four",
             apart(&whole, &finer) / 4.0);
}

/* E14.1, E9.8, E9.17: a slider-crank with a rod that bends by some % of its length, as one body and as four. */
static void turn_crank(path *p, int cut, double T, int steps)
{
  const double a = 0.15, length = 0.3, spin = 60.0;
  const int last = cut;
  fb_section section;
  fb_system_input middle;
  memset(&section, 0, sizeof section);
  memset(p, 0, sizeof *p);
  section.mass = FB_R(0.5);
  section.EI_z = FB_R(1.0);
  fresh();
  rigid(&model[1], 0.0, 0.5 * a, 0, 0, 0, 0, 0);
  rigid(&model[2], 0.0755, 0, 0, 0, 0, 0, 0);
  part(&model[0], &section, length / cut, cut > 1 ? 2 : 4, 1, 0.0);
  hang(0, 1, FB_JOINT_REVOLUTE, FB_GROUND, 0);
  for (int k = 0; k < cut; k++) {
    hang(1 + k, 0, k ? FB_JOINT_RIGID : FB_JOINT_REVOLUTE, k, 1);
  }
  hang(last + 1, 2, FB_JOINT_PRISMATIC, FB_GROUND, 0);
  turn(desc.joint[last + 1].attitude, 0, 0.5 * pi, 0); /* z of the joint along x */
  turn(desc.joint[last + 1].child_attitude, 0, 0.5 * pi, 0);
  close_loop(FB_JOINT_REVOLUTE, last, 1, last + 1, 0);
  desc.joint[0].mode[0] = FB_AXIS_PRESCRIBED;
  input.drive[0].rate[0] = start[0].speed[0] = (fb_real)spin;
  start[1].speed[0] = (fb_real)(-spin - a * spin / length);
  start[last + 1].value[0] = (fb_real)(a + length);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  middle = input;
  for (int sample = 0; sample < SAMPLES; sample++) {
    double x[3], chord[2];
    for (int k = 0; k < steps; k++) {
      const double dt = T / (SAMPLES * steps), t = dt * (sample * steps + k);
      fb_system_input end = input;
      middle.drive[0].value[0] = (fb_real)(spin * (t + 0.5 * dt));
      end.drive[0].value[0] = (fb_real)(spin * (t + dt));
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &middle, &end, (fb_real)dt), FB_OK);
      input = end;
    }
    node_at(p->x[sample][0], &state, 1 + (cut - 1) / 2, cut > 1 ? 1 : 2); /* the middle */
    node_at(p->x[sample][1], &state, last, 1);
    node_at(x, &state, 0, 1);
    for (int i = 0; i < 2; i++) {
      chord[i] = (p->x[sample][1][i] - x[i]) / length;
      x[i] = p->x[sample][0][i] - x[i];
    }
    p->bent = fmax(p->bent, fabs(chord[0] * x[1] - chord[1] * x[0]) / length);
  }
}

/* E9.25, E9.10: a rod of large deflection in a loop moves as one of four links. */
TEST(slider_cranks_turn_as_finer_ones_do)
{
  static path whole, finer;
  const double T = FBT_LONG(0.15, 0.01);
  turn_crank(&whole, 1, T, FBT_LONG(80, 6));
  turn_crank(&finer, 4, T, FBT_LONG(1200, 80));
  FBT_TRUE(FBT_SHORT || whole.bent > 0.03);
  FBT_BELOW(apart(&whole, &finer), 0.3 * FBT_TOL(1e-3, 1e-2));
  fbt_figure("slider-crank with a rod that bends far [rod lengths]", "rod cut in four", apart(&whole, &finer) / 0.3);
}

/* ---- loops, rows, forces, nodes */

static const double stencil[5] = {1.0 / 12, -2.0 / 3, 0, 2.0 / 3, -1.0 / 12}; /* derivative of fourth order */
static fb_system_state rate, kept;

/* Two bodies with lines, bent by some 20 %, on a joint of that kind. */
static void bent_couple(fb_joint_kind kind, int axis, fb_axis_mode mode)
{
  couple(kind, axis, mode);
  flexible(&model[0], 1, 1, 1, FB_EFFECTS_LARGE);
  for (int k = 0; k < 2; k++) {
    for (int a = 0; a < model[0].n; a++) {
      start[k].q[a] *= FB_R(6.0);
      start[k].q_dot[a] *= FB_R(3.0);
    }
  }
}

/* E9.8 to E9.15, E9.17, E9.19 with E14.14, E14.16: on lines, too, every kind of joint moves two bodies alike from joint
   coordinates, by the dense matrix and as a loop of free bodies, forwards and backwards; at the start, after a while, and
   after an axis is locked in motion. */
TEST(every_joint_on_lines_is_the_same_eliminated_or_closing_a_loop)
{
  static fb_system_motion first[3];
  for (int kind = (int)FB_JOINT_RIGID; kind < (int)FB_JOINT_COUNT; kind++) {
    const int ball = kind == FB_JOINT_SPHERICAL, axes = ball ? 1 : axes_of(kind)->count;
    const int forms = ball || axes_of(kind)->tilt >= 0 ? 3 : 4; /* their axes have an order */
    for (int given = 0; given <= (axes > 0 ? 2 : 0); given++) { /* the last axis is locked, prescribed */
      for (int form = 0; form < forms; form++) {
        const int joint = form < 2 ? 1 : 2;
        bent_couple((fb_joint_kind)kind, axes > 0 ? axes - 1 : 0, (fb_axis_mode)given);
        if (form >= 2) {
          couple_by_a_loop(&first[0], form == 3);
        }
        init(form < 2 ? form : (int)FB_METHOD_RECURSIVE);
        FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
        for (int instant = 0; instant < 3; instant++) {
          couple_steps(instant > 0 ? 10 : 0, FBT_TOL(2e-4, 1e-3));
          if (instant == 2 && axes > 0) {
            FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &state, &work, joint, axes - 1, FB_AXIS_LOCKED, &input),
                       FB_OK);
            couple_steps(5, FBT_TOL(2e-4, 1e-3));
          }
          FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
          first[instant] = form ? first[instant] : motion;
          motion.joint[1] =
              form == 3 ? first[instant].joint[1] : motion.joint[joint]; /* they are about the other frame */
          FBT_BELOW(motion_difference(&motion, &first[instant]), instant ? FBT_TOL(1e-8, 3e-2) : FBT_TOL(1e-10, 5e-3));
        }
      }
    }
  }
}

/* No velocity of node 1 of body 1 along user's direction. */
static int on_its_plane(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  const double *const hold = (const double *)user;
  (void)capacity, (void)t, (void)pose;
  row[0].body[0] = 1;
  row[0].node[0] = 1;
  row[0].body[1] = FB_GROUND;
  for (int i = 0; i < 3; i++) {
    row[0].force[0][i] = (fb_real)hold[i];
  }
  return 1;
}

/* E9.10, E9.13 with E14.14: the caller's row on a node of a line does no work and keeps that node where it is along the
   row; by either method and with the joint as a loop. */
TEST(rows_hold_nodes_of_lines)
{
  double hold[3] = {0.6, 0.0, 0.8};
  for (int form = 0; form < FORMS; form++) {
    double before, x[3], y[3], energy;
    bent_couple(FB_JOINT_UNIVERSAL, 0, FB_AXIS_FREE);
    input.n_load = 0;
    memset(&input.drive[1], 0, sizeof input.drive[1]);
    memset(desc.joint[1].damping, 0, sizeof desc.joint[1].damping);
    input.rows = on_its_plane;
    input.user = hold;
    init(form);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    before = energy_of(&state);
    node_at(x, &state, 1, 1);
    for (int k = 0; k < 200; k++) {
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(2e-4)), FB_OK);
    }
    energy = energy_of(&state);
    node_at(y, &state, 1, 1);
    FBT_NEAR_REL(energy, before, FBT_TOL(1e-8, 1e-3));
    FBT_NEAR_ABS(hold[0] * (y[0] - x[0]) + hold[2] * (y[2] - x[2]), 0.0, FBT_TOL(1e-9, 1e-4));
    FBT_BELOW(1e-3, fabs(y[1] - x[1]));
  }
}

/* E9.19, E14.15, E14.16: the force of the joint at the root of a tree with lines is the rate of the momentum of all that
   hangs on it, less gravity, by differences; nodes on lines accelerate as their velocities change. */
TEST(joint_forces_on_lines_carry_what_hangs_on_them)
{
  const double h = FBT_TOL(1e-4, 1e-2), g = 9.81;
  static fb_system_motion at, side;
  fb_node_motion now, node;
  fb_momentum momentum;
  double F[3] = {0.0, 0.0, 0.0}, a[4][3], alpha[4][3];
  tree(FB_EFFECTS_LARGE, 1);
  body_desc.gravity[2] = -(fb_real)g;
  body_desc.effects = FB_EFFECT_GRAVITY;
  rigid(&model[0], 3.0, 0.1, -0.05, 0.02, 0.3, 0.4, 0.5);
  flexible(&model[1], 2, 1, 1, FB_EFFECTS_LARGE | FB_EFFECT_GRAVITY);
  rigid(&model[2], 0.7, 0.2, 0.1, -0.1, 0.03, 0.05, 0.04);
  for (int k = 0; k < desc.n_body; k++) {
    for (int i = 0; i < model[desc.model[k]].n; i++) {
      start[k].q[i] *= FB_R(6.0);
    }
  }
  desc.joint[0].kind = FB_JOINT_RIGID;
  desc.joint[0].parent = FB_GROUND;
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, &input), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &at, &state, &input), FB_OK);
  memset(a, 0, sizeof a);
  memset(alpha, 0, sizeof alpha);
  for (int s = -2; s <= 2; s++) {
    moved(&kept, &state, &rate, s * h);
    FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &momentum, &kept, &input), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &side, &kept, &input), FB_OK);
    for (int i = 0; i < 3; i++) {
      F[i] += stencil[s + 2] / h * (double)momentum.linear[i];
    }
    for (int k = 0; k < 4; k++) { /* bodies 1 and 2 have lines; tip and middle */
      FBT_INT_EQ(fb_body_node_motion_eval(&model[1], &node, &side.pose[1 + k / 2], &side.motion[1 + k / 2], 1 + k % 2),
                 FB_OK);
      for (int i = 0; i < 3; i++) {
        a[k][i] += stencil[s + 2] / h * (double)node.velocity[i];
        alpha[k][i] += stencil[s + 2] / h * (double)node.angular_rate[i];
      }
    }
  }
  for (int i = 0; i < 3; i++) {
    double weight = 0.0;
    for (int k = 0; k < desc.n_body && i == 2; k++) {
      weight += (double)model[desc.model[k]].mass * g;
    }
    FBT_NEAR_ABS(at.joint[0].force[i], F[i] + weight, FBT_TOL(1e-7, 3e-1));
  }
  for (int k = 0; k < 4; k++) {
    FBT_INT_EQ(fb_body_node_motion_eval(&model[1], &now, &at.pose[1 + k / 2], &at.motion[1 + k / 2], 1 + k % 2), FB_OK);
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(now.acceleration[i], a[k][i], FBT_TOL(3e-8, 1e-3) * fbt_largest(now.acceleration, 3));
      FBT_NEAR_ABS(now.angular_acceleration[i], alpha[k][i],
                   FBT_TOL(3e-8, 1e-3) * fbt_largest(now.angular_acceleration, 3));
    }
  }
}

/* E9.19 with lines: the reactions on a body are what its joints bear, about its origin in its axes, in every form. */
TEST(reactions_on_lines_are_the_sum_of_joint_forces)
{
  for (int form = 0; form < FORMS; form++) {
    bent_couple(FB_JOINT_UNIVERSAL, 1, FB_AXIS_PRESCRIBED);
    init(form);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    motion_of(&motion, &state);
    reactions_are_of_joint(1, FBT_TOL(1e-10, 1e-2));
  }
}

/* F, T += force and torque about O of body k, in its axes, of joint j on that body's hub, if it is there */
static void hub_load_add(double F[3], double T[3], int k, int j)
{
  const int loop = j >= desc.n_body, child = loop ? desc.loop[j - desc.n_body].child : j;
  const fb_joint_desc *const joint = loop ? &desc.loop[j - desc.n_body] : &desc.joint[j];
  const int node = loop ? joint->child_node : 0, as_child = child == k && node == 0;
  const double sign = as_child ? 1.0 : -1.0;
  fb_node_motion at;
  fb_real R[9], arm[3], moment[3], own[3];
  if (!as_child && !(joint->parent == k && joint->parent_node == 0)) {
    return;
  }
  FBT_INT_EQ(fb_body_node_motion_eval(&model[desc.model[child]], &at, &motion.pose[child], &motion.motion[child], node),
             FB_OK);
  fb_quat_to_mat33(R, at.quat);
  fb_mat33_mul_vec3(arm, R, joint->child_position);
  for (int i = 0; i < 3; i++) {
    arm[i] += at.position[i] - motion.pose[k].rho[i];
  }
  fb_vec3_cross(moment, arm, motion.joint[j].force);
  for (int i = 0; i < 3; i++) {
    moment[i] += motion.joint[j].torque[i];
  }
  fb_quat_to_mat33(R, motion.pose[k].quat);
  fb_mat33_mulT_vec3(own, R, motion.joint[j].force);
  for (int i = 0; i < 3; i++) {
    F[i] += sign * (double)own[i];
  }
  fb_mat33_mulT_vec3(own, R, moment);
  for (int i = 0; i < 3; i++) {
    T[i] += sign * (double)own[i];
  }
}

static fb_status blow_by_body(fb_line_point *p, int n, fb_real t, void *user)
{
  for (int k = 0; k < n; k++) {
    for (int i = 0; i < 3; i++) {
      p[k].force[i] = p[k].length * (fb_real)sin(1.0 + 2.0 * i + 3.0 * (double)p[k].x + (double)p[k].body + (double)t);
      p[k].torque[i] = FB_R(0.3) * p[k].length * (fb_real)cos(2.0 - i + (double)p[k].body);
    }
  }
  (void)user;
  return FB_OK;
}

/* Loads at nodes of lines: the tip's is that of the last point. */
static void node_loads_are_between(const fb_line_motion *point, int n, int k)
{
  const fb_body *const own = &model[desc.model[k]];
  fb_node_loads loads;
  for (int node = 1; node < own->n_node; node++) {
    FBT_INT_EQ(fb_system_node_loads_eval(&mechanism, model, &loads, &motion, &input, k, node), FB_OK);
    for (int i = 0; i < 3 && own->node[node].line.x >= point[n - 1].at.x; i++) {
      FBT_NEAR_ABS(loads.force[i], point[n - 1].force[i], FBT_TOL(1e-11, 1e-3));
      FBT_NEAR_ABS(loads.moment[i], point[n - 1].moment[i], FBT_TOL(1e-11, 1e-3));
    }
  }
  FBT_INT_EQ(fb_system_node_loads_eval(&mechanism, model, &loads, &motion, &input, k, 0), FB_ERR_UNSUPPORTED);
  FBT_INT_EQ(fb_system_node_loads_eval(&mechanism, model, &loads, &motion, &input, desc.n_body, 1), FB_ERR_CAPACITY);
}

/* Newton and Euler for the hub of every body with a line (flexible: 0.5 kg, 0.02 kg m^2): what its joints and the root of
   its line exert on it. Only loads that the line hands on from its nodes reach it. */
static void hubs_are_in_balance(double tol)
{
  for (int k = 0; k < desc.n_body; k++) {
    static fb_line_motion point[FB_MAX_LINE_POINTS];
    const fb_motion *const own = &motion.motion[k];
    double F[3] = {0}, T[3] = {0};
    int n;
    if (model[desc.model[k]].n == 0) {
      continue;
    }
    FBT_INT_EQ(fb_system_lines_eval(&mechanism, model, point, &n, &motion, &input, k), FB_OK);
    FBT_INT_EQ(point[0].at.body, k);
    node_loads_are_between(point, n, k);
    for (int j = 0; j < desc.n_body + desc.n_loop; j++) {
      hub_load_add(F, T, k, j);
    }
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(F[i] + (double)point[0].force[i], 0.5 * (double)own->acceleration[i], tol);
      FBT_NEAR_ABS(T[i] + (double)point[0].moment[i], 0.02 * (double)own->w_dot[i], tol);
    }
  }
}

/* Springs from node 2 of one line to the ground and to the tip of the other. */
static void springs_on_lines(void)
{
  for (int j = 0; j < 2; j++) {
    fb_spring *const s = &desc.spring[desc.n_spring++];
    s->node[0] = 2;
    s->body[1] = j ? 1 : FB_GROUND;
    s->node[1] = j;
    s->position[1][j] = FB_R(0.7);
    s->position[0][2] = FB_R(0.1);
    s->stiffness = FB_R(3.0);
    s->length = FB_R(0.2);
    s->damping = FB_R(0.1);
    input.pull[j] = FB_R(0.4);
  }
}

static fb_status push_on_lines(fb_system_forces *now, void *user)
{
  for (int i = 0; i < now->n_point; i++) {
    now->point[i].force[i % 3] = now->point[i].node ? now->point[i].velocity[0] + FB_R(0.3) : FB_R(0.0);
    now->point[i].torque[1] = now->point[i].node ? FB_R(0.2) : FB_R(0.0);
  }
  (void)user;
  return FB_OK;
}

/* E14.41 in systems: all kinds of joints on nodes of lines, by elimination, one dense matrix, and closing a loop
   forwards and backwards; distributed loads, springs, forces of the state. */
TEST(internal_loads_of_systems_reach_the_hub)
{
  static fb_system_motion first;
  for (int kind = (int)FB_JOINT_RIGID; kind < (int)FB_JOINT_COUNT; kind++) {
    const int forms = kind == FB_JOINT_SPHERICAL || axes_of(kind)->tilt >= 0 ? 3 : 4; /* their axes have an order */
    for (int form = 0; form < forms; form++) {
      bent_couple((fb_joint_kind)kind, 0, FB_AXIS_FREE);
      if (form >= 2) {
        couple_by_a_loop(&first, form == 3);
      }
      input.distributed = blow_by_body;
      input.forces = push_on_lines;
      springs_on_lines();
      init(form < 2 ? form : (int)FB_METHOD_RECURSIVE);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
      first = form ? first : motion;
      hubs_are_in_balance(FBT_TOL(2e-6, 2e-2)); /* body: linear terms of the beam; points: of their quadrature */
    }
  }
}

/* Interface: a body without lines, rows, numbers of no body. */
TEST(internal_loads_of_systems_that_are_not_known_are_refused)
{
  static fb_line_motion point[FB_MAX_LINE_POINTS];
  int n = 7;
  bent_couple(FB_JOINT_REVOLUTE, 0, FB_AXIS_FREE);
  rigid(&model[1], 1.0, 0, 0, 0, 1, 1, 1);
  hang(2, 1, FB_JOINT_REVOLUTE, 0, 1);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
  FBT_INT_EQ(fb_system_lines_eval(&mechanism, model, point, &n, &motion, &input, 2), FB_ERR_UNSUPPORTED);
  FBT_INT_EQ(fb_system_lines_eval(&mechanism, model, point, &n, &motion, &input, 3), FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_system_lines_eval(&mechanism, model, point, &n, &motion, &input, -1), FB_ERR_CAPACITY);
  input.rows = on_its_plane;
  FBT_INT_EQ(fb_system_lines_eval(&mechanism, model, point, &n, &motion, &input, 0), FB_ERR_UNSUPPORTED);
  FBT_INT_EQ(n, 7);
}

SUITE(system_machines, RUN(double_pendulums_of_lines_follow_the_reference),
      RUN_LONG(folded_booms_unfold_as_finer_ones_do), RUN(hinged_rotors_turn_as_finer_ones_do),
      RUN_LONG(slider_cranks_turn_as_finer_ones_do),
      RUN_LONG(every_joint_on_lines_is_the_same_eliminated_or_closing_a_loop), RUN(rows_hold_nodes_of_lines),
      RUN(joint_forces_on_lines_carry_what_hangs_on_them), RUN(reactions_on_lines_are_the_sum_of_joint_forces),
      RUN(internal_loads_of_systems_reach_the_hub), RUN(internal_loads_of_systems_that_are_not_known_are_refused))
