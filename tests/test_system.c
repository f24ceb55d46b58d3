/* Section 9: joints, trees, loops: the same motion by eliminated and by kept constraints, conservation, closed forms and
   references of rigid and flexible mechanisms. */
#include "fbt.h"

static fb_beam_desc beam_desc;
static fb_beam beam;
static fb_modes modes;
static fb_modes_work modes_work;
static fb_shape shape;
static fb_body_desc body_desc;
static fb_body_work body_work;
static fb_body model[FB_MAX_BODIES];
static fb_system_desc desc;
static fb_system mechanism;
static fb_system_work work;
static fb_system_state state, kept, rate;
static fb_system_input input;
static fb_system_motion motion;
static fb_link_motion start[FB_MAX_BODIES];

static void fresh(void)
{
  memset(&desc, 0, sizeof desc);
  memset(&input, 0, sizeof input);
  memset(start, 0, sizeof start);
  memset(&body_desc, 0, sizeof body_desc);
  memset(&beam_desc, 0, sizeof beam_desc);
}

/* A rigid body about its origin. */
static void rigid(fb_body *body, double mass, double cx, double cy, double cz, double jx, double jy, double jz)
{
  const fb_real center[3] = {(fb_real)cx, (fb_real)cy, (fb_real)cz};
  const fb_real inertia[6] = {(fb_real)jx, (fb_real)jy, (fb_real)jz, 0, 0, 0};
  const fb_real r[3] = {(fb_real)(2.0 * cx), (fb_real)(2.0 * cy), (fb_real)(2.0 * cz)};
  int node;
  fb_body_desc d = body_desc;
  d.base = FB_BASE_PRESCRIBED;
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)mass, center, inertia), FB_OK);
  FBT_INT_EQ(fb_shape_add_node(&shape, &node, r, NULL, NULL), FB_OK);
  FBT_INT_EQ(fb_body_init(body, &body_work, &shape, &d), FB_OK);
}

/* A slender beam along x, nodes 1 at the tip and 2 in the middle: y, z bending modes, t of torsion. */
static void flexible(fb_body *body, int y, int z, int t, unsigned effects)
{
  const fb_real root[3] = {0}, inertia[6] = {FB_R(0.02), FB_R(0.02), FB_R(0.02), 0, 0, 0};
  fb_modes_desc keep;
  int node;
  fb_body_desc d = body_desc;
  memset(&keep, 0, sizeof keep);
  beam_desc.length = FB_R(1.0);
  beam_desc.n_element = 6;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = FB_R(0.8);
  beam_desc.station[0].EI_y = FB_R(3.0);
  beam_desc.station[0].EI_z = FB_R(2.0);
  beam_desc.station[0].GJ = FB_R(1.5);
  beam_desc.station[0].i_y = FB_R(0.004);
  beam_desc.station[0].i_z = FB_R(0.003);
  keep.count[FB_KIND_BEND_Y] = y;
  keep.count[FB_KIND_BEND_Z] = z;
  keep.count[FB_KIND_TORSION] = t;
  d.base = FB_BASE_PRESCRIBED;
  d.effects = effects;
  d.deflection_limit = FB_R(1.0);
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(0.5), root, inertia),
             FB_OK); /* a clamped beam alone has none to move freely */
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, FB_R(1.0)), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, FB_R(0.5)), FB_OK);
  FBT_INT_EQ(fb_body_init(body, &body_work, &shape, &d), FB_OK);
}

static void hang(int k, int body, fb_joint_kind kind, int parent, int node)
{
  fb_joint_desc *j = &desc.joint[k];
  desc.n_body = k + 1 > desc.n_body ? k + 1 : desc.n_body;
  desc.model[k] = body;
  j->kind = kind;
  j->parent = parent;
  j->parent_node = node;
}

static void turn(fb_real quat[4], double x, double y, double z)
{
  const fb_real phi[3] = {(fb_real)x, (fb_real)y, (fb_real)z};
  fb_quat_from_rotvec(quat, phi);
}

static void init(fb_method method)
{
  desc.method = method;
  FBT_INT_EQ(fb_system_init(&mechanism, &work, model, FB_MAX_BODIES, &desc), FB_OK);
}

/* A tree with every kind of joint: free hub, flexible links, offsets and turned axes on both sides, springs and dampers;
   in motion. */
static void tree(unsigned effects, int damped)
{
  fresh();
  rigid(&model[0], 3.0, 0.1, -0.05, 0.02, 0.3, 0.4, 0.5);
  flexible(&model[1], 2, 1, 1, effects);
  rigid(&model[2], 0.7, 0.2, 0.1, -0.1, 0.03, 0.05, 0.04);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  hang(1, 1, FB_JOINT_REVOLUTE, 0, 1);
  hang(2, 1, FB_JOINT_UNIVERSAL, 1, 1);
  hang(3, 2, FB_JOINT_SPHERICAL, 2, 1);
  hang(4, 2, FB_JOINT_CYLINDRICAL, 1, 2);
  hang(5, 2, FB_JOINT_SCREW, 0, 0);
  hang(6, 2, FB_JOINT_PRISMATIC, 3, 1);
  hang(7, 2, FB_JOINT_RIGID, 2, 2);
  fbt_seed(7);
  for (int k = 0; k < desc.n_body; k++) {
    fb_joint_desc *j = &desc.joint[k];
    for (int i = 0; i < 3 && k > 0; i++) {
      j->position[i] = (fb_real)(0.1 * fbt_random());
      j->child_position[i] = (fb_real)(0.1 * fbt_random());
      j->stiffness[i] = (fb_real)(1.0 + fbt_random());
      j->rest[i] = (fb_real)(0.2 * fbt_random());
      j->damping[i] = (fb_real)(damped ? 0.1 * (1.0 + fbt_random()) : 0.0);
    }
    if (k > 0) {
      turn(j->attitude, fbt_random(), fbt_random(), fbt_random());
      turn(j->child_attitude, fbt_random(), fbt_random(), fbt_random());
    }
    j->pitch = FB_R(0.1);
    for (int i = 0; i < 3; i++) {
      start[k].value[i] = (fb_real)(0.3 * fbt_random());
    }
    turn(start[k].quat, 0.5 * fbt_random(), 0.5 * fbt_random(), 0.5 * fbt_random());
    for (int i = 0; i < 6; i++) {
      start[k].speed[i] = (fb_real)fbt_random();
    }
    for (int a = 0; a < model[desc.model[k]].n; a++) {
      start[k].q[a] = (fb_real)(0.02 * fbt_random());
      start[k].q_dot[a] = (fb_real)(0.2 * fbt_random());
    }
  }
}

static double energy_of(const fb_system_state *s)
{
  fb_energy e;
  FBT_INT_EQ(fb_system_energy(&mechanism, model, &work, &e, s, &input), FB_OK);
  return (double)(e.kinetic + e.strain + e.gravity);
}

/* state + h rate, coordinate by coordinate */
static void moved(fb_system_state *out, const fb_system_state *s, const fb_system_state *r, double h)
{
  *out = *s;
  for (int k = 0; k < desc.n_body; k++) {
    for (int i = 0; i < 3; i++) {
      out->link[k].x[i] += (fb_real)h * r->link[k].x[i];
    }
    for (int i = 0; i < 4; i++) {
      out->link[k].quat[i] += (fb_real)h * r->link[k].quat[i];
    }
    for (int i = 0; i < 6; i++) {
      out->link[k].p[i] += (fb_real)h * r->link[k].p[i];
    }
    for (int a = 0; a < model[desc.model[k]].n; a++) {
      out->link[k].q[a] += (fb_real)h * r->link[k].q[a];
      out->link[k].pi[a] += (fb_real)h * r->link[k].pi[a];
    }
  }
}

/* E9.14, E9.12, E9.15: along the rates of a tree in free motion the energy, the momentum and the angular momentum about
   the inertial origin do not change, for every set of effects that is whole. */
TEST(systems_keep_energy_and_momentum)
{
  static const unsigned sets[] = {FB_EFFECTS_FULL, FB_EFFECTS_SPIN, FB_EFFECTS_LINEAR, FB_EFFECTS_RIGID};
  for (int run = 0; run < 8; run++) {
    const double h = FBT_TOL(1e-4, 1e-2);
    double slope = 0.0;
    fb_momentum at, before;
    tree(sets[run / 2], 0);
    init(run % 2 ? FB_METHOD_DENSE : FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    memset(&rate, 0, sizeof rate);
    FBT_INT_EQ(fb_system_rates(&mechanism, model, &work, &rate, &state, &input), FB_OK);
    FBT_INT_EQ(fb_system_momentum(&mechanism, model, &work, &before, &state, &input), FB_OK);
    for (int side = -2; side <= 2; side++) {
      static const double weight[5] = {1.0 / 12, -2.0 / 3, 0, 2.0 / 3, -1.0 / 12};
      moved(&kept, &state, &rate, side * h);
      slope += weight[side + 2] / h * energy_of(&kept);
      FBT_INT_EQ(fb_system_momentum(&mechanism, model, &work, &at, &kept, &input), FB_OK);
      FBT_BELOW(fbt_difference(at.linear, before.linear, 3), FBT_TOL(1e-13, 1e-4) * 10.0);
    }
    FBT_NEAR_ABS(slope, 0.0, FBT_TOL(1e-9, 1e-1));
  }
}

/* Largest difference of poses, velocities and accelerations of all bodies, and of joint forces. */
static double motion_difference(const fb_system_motion *a, const fb_system_motion *b)
{
  double worst = 0.0;
  for (int k = 0; k < desc.n_body; k++) {
    const fb_motion *x = &a->motion[k], *y = &b->motion[k];
    const int n = model[desc.model[k]].n;
    double sign = 0.0;
    for (int i = 0; i < 4; i++) {
      sign += (double)(a->pose[k].quat[i] * b->pose[k].quat[i]);
    }
    worst = fmax(worst, fabs(fabs(sign) - 1.0));
    worst = fmax(worst, fbt_difference(a->pose[k].rho, b->pose[k].rho, 3));
    worst = fmax(worst, fbt_difference(a->pose[k].q, b->pose[k].q, n));
    worst = fmax(worst, fmax(fbt_difference(x->v, y->v, 3), fbt_difference(x->w, y->w, 3)));
    worst = fmax(worst, fbt_difference(x->q_dot, y->q_dot, n));
    worst = fmax(worst, fmax(fbt_difference(x->v_dot, y->v_dot, 3), fbt_difference(x->w_dot, y->w_dot, 3)) / 100.0);
    worst = fmax(worst, fbt_difference(x->q_ddot, y->q_ddot, n) / 1000.0);
    worst = fmax(worst, fbt_difference(x->reaction_force, y->reaction_force, 3) / 100.0);
    worst = fmax(worst, fbt_difference(x->reaction_torque, y->reaction_torque, 3) / 100.0);
    worst = fmax(worst, fbt_difference(a->joint[k].force, b->joint[k].force, 3) / 100.0);
    worst = fmax(worst, fbt_difference(a->joint[k].torque, b->joint[k].torque, 3) / 100.0);
    worst = fmax(worst, fbt_difference(a->joint[k].speed, b->joint[k].speed, 3) * (k > 0));
    worst = fmax(worst, fbt_difference(a->joint[k].drive, b->joint[k].drive, 3) / 100.0);
  }
  return worst;
}

/* Motors, loads on nodes in all axes, some axes locked, some prescribed. */
static void drives(void)
{
  for (int k = 1; k < desc.n_body; k++) {
    for (int i = 0; i < 3; i++) {
      input.drive[k].torque[i] = (fb_real)(0.3 * fbt_random());
    }
  }
  input.n_load = 3;
  for (int i = 0; i < 3; i++) {
    input.load[i].body = i;
    input.load[i].load.node = 1;
    input.load[i].load.axes = (fb_axes)i;
    for (int j = 0; j < 3; j++) {
      input.load[i].load.force[j] = (fb_real)fbt_random();
      input.load[i].load.torque[j] = (fb_real)(0.2 * fbt_random());
    }
  }
  desc.joint[1].mode[0] = FB_AXIS_PRESCRIBED;
  desc.joint[4].mode[1] = FB_AXIS_LOCKED;
  desc.joint[2].mode[1] = FB_AXIS_PRESCRIBED;
  start[4].speed[1] = 0;
  for (int k = 1; k < 3; k++) {
    const int i = k - 1;
    input.drive[k].value[i] = start[k].value[i];
    input.drive[k].rate[i] = start[k].speed[i];
    input.drive[k].acceleration[i] = (fb_real)(0.5 * k);
  }
}

static void stepped(fb_system_state *s, int n, double dt)
{
  fb_system_input middle = input, end = input;
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, s, start, &input), FB_OK);
  for (int step = 0; step < n; step++) {
    const double t[3] = {dt * step, dt * (step + 0.5), dt * (step + 1)};
    fb_system_input *at[3];
    at[0] = &input;
    at[1] = &middle;
    at[2] = &end;
    for (int i = 0; i < 3; i++) {
      for (int k = 1; k < 3; k++) {
        fb_drive *d = &at[i]->drive[k];
        const double a = 0.5 * k;
        d->value[k - 1] =
            start[k].value[k - 1] + (fb_real)t[i] * start[k].speed[k - 1] + (fb_real)(0.5 * a * t[i] * t[i]);
        d->rate[k - 1] = start[k].speed[k - 1] + (fb_real)(a * t[i]);
      }
    }
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, s, &work, &input, &middle, &end, (fb_real)dt), FB_OK);
  }
  input = end;
}

/* E9.3 to E9.10, E9.13, E9.15, E9.19: joint coordinates by recursion and by one dense matrix, and every body free with all
   joints kept, give the same positions, velocities, accelerations and joint forces: at one instant to rounding, after a
   while to 1e-9 (kept constraints integrate other coordinates, with an error of the same order). */
TEST(the_three_methods_agree)
{
  static fb_system_motion recursive, first;
  for (int run = 0; run < 2; run++) {
    for (int method = 0; method < 3; method++) {
      tree(run ? FB_EFFECTS_SPIN : FB_EFFECTS_FULL, 1);
      drives();
      init((fb_method)method);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
      if (method == 0) {
        first = motion;
      }
      FBT_BELOW(motion_difference(&motion, &first), FBT_TOL(1e-11, 1e-3));
      stepped(&state, FB_SINGLE ? 20 : 200, FB_SINGLE ? 2e-3 : 2e-4);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
      if (method == 0) {
        recursive = motion;
      }
      FBT_BELOW(motion_difference(&motion, &recursive), FBT_TOL(1e-9, 1e-2));
    }
  }
}

/* E9.18, E9.19: accelerations are the rates of the velocities along the rates of the state, for all bodies, modes and
   joints, with motors, loads and prescribed axes. */
TEST(accelerations_are_the_rates_of_velocities)
{
  static fb_system_motion at, side;
  const double h = FBT_TOL(1e-4, 1e-2);
  double worst = 0.0;
  tree(FB_EFFECTS_FULL, 1);
  drives();
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_rates(&mechanism, model, &work, &rate, &state, &input), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &at, &state, &input), FB_OK);
  for (int s = -2; s <= 2; s++) {
    static const double weight[5] = {1.0 / 12, -2.0 / 3, 0, 2.0 / 3, -1.0 / 12};
    fb_system_input moving = input;
    for (int k = 1; k < 3; k++) {
      moving.drive[k].rate[k - 1] += (fb_real)(s * h) * moving.drive[k].acceleration[k - 1];
    }
    moved(&kept, &state, &rate, s * h);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &side, &kept, &moving), FB_OK);
    for (int k = 0; k < desc.n_body; k++) {
      for (int i = 0; i < 3; i++) {
        at.motion[k].v_dot[i] -= (fb_real)(weight[s + 2] / h) * side.motion[k].v[i];
        at.motion[k].w_dot[i] -= (fb_real)(weight[s + 2] / h) * side.motion[k].w[i];
        at.joint[k].acceleration[i] -= (fb_real)(weight[s + 2] / h) * side.joint[k].speed[i];
      }
      for (int a = 0; a < model[desc.model[k]].n; a++) {
        at.motion[k].q_ddot[a] -= (fb_real)(weight[s + 2] / h) * side.motion[k].q_dot[a];
      }
    }
  }
  for (int k = 0; k < desc.n_body; k++) {
    worst = fmax(worst, fmax(fbt_largest(at.motion[k].v_dot, 3), fbt_largest(at.motion[k].w_dot, 3)));
    worst = fmax(worst, fbt_largest(at.motion[k].q_ddot, model[desc.model[k]].n));
    worst = fmax(worst, fbt_largest(at.joint[k].acceleration, 3));
  }
  FBT_BELOW(worst, FBT_TOL(1e-8, 1.0));
}

SUITE(system, RUN(systems_keep_energy_and_momentum), RUN(the_three_methods_agree),
      RUN(accelerations_are_the_rates_of_velocities))
