/* Section 9: joints, trees, loops: the same motion by eliminated and by kept constraints, conservation, closed forms
   and references of rigid and flexible mechanisms. */
#include "fbt.h"

static const double pi = 3.14159265358979323846;
static int implicit; /* 0: rk4, else the iterations of sdirk */

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
static fb_system_analyse_work analyse_work;
static fb_spectrum spectrum;
static fb_system_state state, kept, rate;
static fb_system_input input;
static fb_system_motion motion;
static fb_link_motion start[FB_MAX_BODIES];
static double kilogram = 1.0, meter = 1.0, second = 1.0; /* what bodies are measured in */

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
  const double J = kilogram * meter * meter;
  const fb_real center[3] = {(fb_real)(cx * meter), (fb_real)(cy * meter), (fb_real)(cz * meter)};
  const fb_real inertia[6] = {(fb_real)(jx * J), (fb_real)(jy * J), (fb_real)(jz * J), 0, 0, 0};
  const fb_real r[3] = {FB_R(2.0) * center[0], FB_R(2.0) * center[1], FB_R(2.0) * center[2]};
  int node;
  fb_body_desc d = body_desc;
  d.base = FB_BASE_PRESCRIBED;
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)(mass * kilogram), center, inertia), FB_OK);
  FBT_INT_EQ(fb_shape_add_node(&shape, &node, r, NULL, NULL), FB_OK);
  FBT_INT_EQ(fb_body_init(body, &body_work, &shape, &d), FB_OK);
}

/* A slender beam along x, nodes 1 at the tip and 2 in the middle: y, z bending modes, t of torsion. */
static void flexible(fb_body *body, int y, int z, int t, unsigned effects)
{
  const fb_real J = (fb_real)(0.02 * kilogram * meter * meter), root[3] = {0}, inertia[6] = {J, J, J, 0, 0, 0};
  const double EI = kilogram * pow(meter, 3.0) / (second * second);
  fb_modes_desc keep;
  int node;
  fb_body_desc d = body_desc;
  memset(&keep, 0, sizeof keep);
  beam_desc.length = (fb_real)meter;
  beam_desc.n_element = 6;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = (fb_real)(0.8 * kilogram / meter);
  beam_desc.station[0].EI_y = (fb_real)(3.0 * EI);
  beam_desc.station[0].EI_z = (fb_real)(2.0 * EI);
  beam_desc.station[0].GJ = (fb_real)(1.5 * EI);
  beam_desc.station[0].i_y = (fb_real)(0.004 * kilogram * meter);
  beam_desc.station[0].i_z = (fb_real)(0.003 * kilogram * meter);
  keep.count[FB_KIND_BEND_Y] = y;
  keep.count[FB_KIND_BEND_Z] = z;
  keep.count[FB_KIND_TORSION] = t;
  d.base = FB_BASE_PRESCRIBED;
  d.effects = effects;
  d.deflection_limit = (fb_real)meter;
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)(0.5 * kilogram), root, inertia),
             FB_OK); /* a clamped beam alone has none to move freely */
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, (fb_real)meter), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, (fb_real)(0.5 * meter)), FB_OK);
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

/* Each component up to size; one after the other, arguments have no order. */
static void turn_anyhow(fb_real quat[4], double size)
{
  double phi[3];
  for (int i = 0; i < 3; i++) {
    phi[i] = size * fbt_random();
  }
  turn(quat, phi[0], phi[1], phi[2]);
}

static void init(fb_method method)
{
  desc.method = method;
  FBT_INT_EQ(fb_system_init(&mechanism, &work, model, FB_MAX_BODIES, &desc), FB_OK);
  FBT_INT_EQ(fb_system_check(&mechanism, model, FB_MAX_BODIES), FB_OK);
}

/* A tree with every kind of joint: free hub, flexible links, offsets and turned axes on both sides, springs and
   dampers; in motion. */
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
      turn_anyhow(j->attitude, 1.0);
      turn_anyhow(j->child_attitude, 1.0);
    }
    j->pitch = FB_R(0.1);
    for (int i = 0; i < 3; i++) {
      start[k].value[i] = (fb_real)(0.3 * fbt_random());
    }
    turn_anyhow(start[k].quat, 0.5);
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
    worst =
        fmax(worst,
             fmax(fbt_difference(x->acceleration, y->acceleration, 3), fbt_difference(x->w_dot, y->w_dot, 3)) / 100.0);
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
        const double a = 0.5 * k / (second * second);
        d->value[k - 1] =
            start[k].value[k - 1] + (fb_real)t[i] * start[k].speed[k - 1] + (fb_real)(0.5 * a * t[i] * t[i]);
        d->rate[k - 1] = start[k].speed[k - 1] + (fb_real)(a * t[i]);
      }
    }
    if (implicit) {
      FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, s, &work, &input, &end, (fb_real)dt, implicit), FB_OK);
    } else {
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, s, &work, &input, &middle, &end, (fb_real)dt), FB_OK);
    }
  }
  input = end;
}

/* E9.3 to E9.10, E9.13, E9.15, E9.19: joint coordinates by recursion and by one dense matrix, and every body free with
   all joints kept, give the same positions, velocities, accelerations, joint forces and energy: at one instant to rounding,
   after a while to 1e-9 (kept constraints integrate other coordinates, with an error of the same order). */
TEST(the_three_methods_agree)
{
  static fb_system_motion recursive, first;
  for (int run = 0; run < 2; run++) {
    double energy = 0.0;
    for (int method = 0; method < 3; method++) {
      tree(run ? FB_EFFECTS_SPIN : FB_EFFECTS_FULL, 1);
      drives();
      init((fb_method)method);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
      if (method == 0) {
        first = motion;
        energy = energy_of(&state);
      }
      FBT_BELOW(motion_difference(&motion, &first), FBT_TOL(1e-11, 1e-3));
      FBT_NEAR_REL(energy_of(&state), energy, FBT_TOL(1e-12, 1e-5));
      stepped(&state, FB_SINGLE ? 20 : 200, FB_SINGLE ? 2e-3 : 2e-4);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
      if (method == 0) {
        recursive = motion;
      }
      FBT_BELOW(motion_difference(&motion, &recursive), FBT_TOL(1e-9, 1e-2));
    }
  }
}

/* Component i of an inertial vector in the axes of an attitude. */
static double turned_back(const fb_real quat[4], const double x[3], int i)
{
  const fb_real inertial[3] = {(fb_real)x[0], (fb_real)x[1], (fb_real)x[2]};
  fb_real R[9], own[3];
  fb_quat_to_mat33(R, quat);
  fb_mat33_mulT_vec3(own, R, inertial);
  return (double)own[i];
}

/* What of a motion the speed of flight must not change: joints, modes, attitudes; by the first, as a difference. */
static double flight_difference(const fb_system_motion *a, const fb_system_motion *b)
{
  double worst = 0.0;
  for (int k = 0; k < desc.n_body; k++) {
    const fb_real back[4] = {b->pose[k].quat[0], -b->pose[k].quat[1], -b->pose[k].quat[2], -b->pose[k].quat[3]};
    fb_real turned[4], phi[3];
    fb_quat_mul(turned, a->pose[k].quat, back);
    fb_quat_to_rotvec(phi, turned);
    worst = fmax(worst, fbt_largest(phi, 3));
    worst = fmax(worst, fbt_difference(a->pose[k].q, b->pose[k].q, model[desc.model[k]].n));
    worst = fmax(worst, k ? fbt_difference(a->joint[k].value, b->joint[k].value, 3) : 0.0);
  }
  return worst;
}

/* A loop in single precision multiplies the rounding of every step, whatever the speed. */
static int flight_steps(int loop)
{
  return loop ? 20 : 60;
}

/* The tree that tree() makes, pushed in all axes, with a loop or without, from its start at a speed along an inertial
   direction; its motion after a while. */
static void fly(fb_system_motion *out, fb_method method, int scheme, int loop, double speed)
{
  const fb_real U[3] = {(fb_real)(speed / 3.0), (fb_real)(2.0 * speed / 3.0), -(fb_real)(2.0 * speed / 3.0)};
  fb_real R[9], u[3];
  tree(FB_EFFECTS_FULL, 1);
  input.n_load = 3;
  for (int i = 0; i < 3; i++) {
    input.load[i].body = i;
    input.load[i].load.node = 1;
    input.load[i].load.axes = (fb_axes)i;
    input.load[i].load.force[i] = FB_R(2.0);
    input.load[i].load.torque[2 - i] = FB_R(0.1);
  }
  if (loop) { /* the hub and a body four joints away, by a ball joint where it is */
    fb_joint_desc *j = &desc.loop[0];
    fb_real away[3];
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, out, &state, &input), FB_OK);
    desc.n_loop = 1;
    j->kind = FB_JOINT_SPHERICAL;
    j->child = 6;
    fb_quat_to_mat33(R, out->pose[0].quat);
    for (int i = 0; i < 3; i++) {
      away[i] = out->pose[6].rho[i] - out->pose[0].rho[i];
    }
    fb_mat33_mulT_vec3(j->position, R, away);
  }
  init(method);
  fb_quat_to_mat33(R, start[0].quat);
  fb_mat33_mulT_vec3(u, R, U);
  for (int i = 0; i < 3; i++) {
    start[0].speed[i] = u[i] + (fb_real)0.25 * (fb_real)(1 + i);
  }
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
  for (int step = 0; step < flight_steps(loop); step++) {
    FBT_INT_EQ(scheme ? fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, FB_R(2e-3), 3)
                      : fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(2e-3)),
               FB_OK);
  }
  FBT_INT_EQ(fb_system_state_check(&mechanism, model, &state), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, out, &state, &input), FB_OK);
}

/* E9.21 to E9.24, E11.23: a system that flies at up to 30 km/s, pushed on the way, moves as the one that does not, by
   every method and scheme, with a loop and without (the equations are invariant, the arithmetic must be). */
TEST(flight_speed_changes_nothing)
{
  static const double speed[] = {100.0, 250.0, 7500.0, 30000.0};
  static fb_system_motion rest;
  for (int run = 0; run < 12; run++) {
    const int method = run / 4, scheme = run / 2 % 2, loop = run % 2;
    fly(&rest, (fb_method)method, scheme, loop, 0.0);
    for (int k = 0; k < FBT_COUNT(speed); k++) {
      const double time = 2e-3 * flight_steps(loop);
      double far = 0.0;
      fly(&motion, (fb_method)method, scheme, loop, speed[k]);
      FBT_BELOW(flight_difference(&motion, &rest), FBT_TOL(1e-9, 2e-5));
      for (int i = 0; i < 3; i++) { /* and gets where it should */
        const double U[3] = {speed[k] / 3.0, 2.0 * speed[k] / 3.0, -2.0 * speed[k] / 3.0};
        far = fmax(far, fabs((double)(motion.pose[0].rho[i] - rest.pose[0].rho[i]) - time * U[i]));
        FBT_NEAR_ABS(motion.motion[0].v[i] - rest.motion[0].v[i], turned_back(motion.pose[0].quat, U, i),
                     FBT_TOL(1e-9, 2e-5) * (1.0 + speed[k]));
      }
      FBT_BELOW(far, FBT_TOL(1e-9, 2e-5) + 8.0 * (double)FB_EPSILON * time * speed[k]);
    }
  }
}

/* E9.21, E9.22: a root that is driven at a constant velocity, then let go: all that hangs on it moves as if it
   had been at rest; the frame of a locked one stands still. */
TEST(driven_roots_fly_as_they_stand)
{
  static fb_system_motion rest;
  for (int run = 0; run < 4; run++) {
    const int scheme = run / 2, fast = run % 2;
    fb_real R[9];
    const fb_real U[3] = {FB_R(2500.0) * (fb_real)fast, -FB_R(5000.0) * (fb_real)fast, FB_R(5000.0) * (fb_real)fast};
    tree(FB_EFFECTS_FULL, 1);
    desc.joint[0].mode[0] = FB_AXIS_PRESCRIBED;
    init(FB_METHOD_RECURSIVE);
    fb_quat_to_mat33(R, start[0].quat);
    fb_mat33_mulT_vec3(input.drive[0].rate, R, U);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    for (int step = 0; step < 40; step++) {
      FBT_INT_EQ(step == 20 ? fb_system_axis_set(&mechanism, model, &work, &state, 0, 0, FB_AXIS_FREE, &input) : FB_OK,
                 FB_OK);
      FBT_INT_EQ(scheme ? fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, FB_R(2e-3), 3)
                        : fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(2e-3)),
                 FB_OK);
    }
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, fast ? &motion : &rest, &state, &input), FB_OK);
    FBT_BELOW(fast ? flight_difference(&motion, &rest) : 0.0, FBT_TOL(1e-9, 2e-5));
    FBT_TRUE(!fast || fbt_largest(state.link[0].u, 3) > 4000.0);
    FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &work, &state, 0, 0, FB_AXIS_LOCKED, &input), FB_OK);
    FBT_TRUE(fbt_largest(state.link[0].u, 3) == 0.0);
  }
}

/* E11.23: momentum and angular momentum about the inertial origin of a free tree in fast flight far from that origin are
   those of the start, to rounding. */
TEST(fast_systems_keep_their_angular_momentum)
{
  for (int scheme = 0; scheme < 2; scheme++) {
    fb_momentum first, now;
    tree(FB_EFFECTS_FULL, 0);
    init(FB_METHOD_RECURSIVE);
    start[0].value[1] = FB_R(5000.0);
    start[0].speed[0] += FB_R(30000.0);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_momentum(&mechanism, model, &work, &first, &state, NULL), FB_OK);
    for (int step = 0; step < 200; step++) {
      FBT_INT_EQ(scheme ? fb_system_sdirk_step(&mechanism, model, &state, &work, NULL, NULL, FB_R(1e-3), 0)
                        : fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, FB_R(1e-3)),
                 FB_OK);
    }
    FBT_INT_EQ(fb_system_momentum(&mechanism, model, &work, &now, &state, NULL), FB_OK);
    FBT_BELOW(fbt_difference(now.linear, first.linear, 3), 4.0 * (double)FB_EPSILON * fbt_largest(first.linear, 3));
    FBT_BELOW(fbt_difference(now.angular, first.angular, 3), 32.0 * (double)FB_EPSILON * fbt_largest(first.angular, 3));
  }
}

/* E9.21: every set of effects keeps the momenta of what flies and spins, in small steps to the error of the scheme. */
TEST(every_set_keeps_the_momenta_of_free_systems)
{
  static const unsigned sets[] = {FB_EFFECTS_LINEAR, FB_EFFECTS_SPIN, FB_EFFECTS_FULL};
  for (int run = 0; run < 6; run++) {
    fb_momentum first, now;
    tree(sets[run / 2], 0);
    init(FB_METHOD_RECURSIVE);
    start[0].speed[0] += run % 2 ? FB_R(10.0) : FB_R(0.0);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_momentum(&mechanism, model, &work, &first, &state, NULL), FB_OK);
    for (int step = 0; step < 500; step++) {
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, FB_R(1e-3)), FB_OK);
    }
    FBT_INT_EQ(fb_system_momentum(&mechanism, model, &work, &now, &state, NULL), FB_OK);
    FBT_BELOW(fbt_difference(now.linear, first.linear, 3), FBT_TOL(1e-12, 1e-5) * fbt_largest(first.linear, 3));
    FBT_BELOW(fbt_difference(now.angular, first.angular, 3), FBT_TOL(1e-9, 1e-5) * fbt_largest(first.linear, 3));
  }
}

/* An arm of three rods from rest, driven by two motors: hinge, ball, hinge. */
static void driven_arm(double torque)
{
  fresh();
  rigid(&model[0], 1.0, 0.5, 0.0, 0.0, 0.3, 0.4, 0.4);
  hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
  hang(1, 0, FB_JOINT_SPHERICAL, 0, 1);
  hang(2, 0, FB_JOINT_REVOLUTE, 1, 1);
  turn(start[1].quat, 0.8, 0.6, 0.0);
  start[2].value[0] = FB_R(0.5);
  input.drive[0].torque[0] = (fb_real)torque;
  input.drive[2].torque[0] = -(fb_real)(torque / 4.0);
}

/* A step of 0.1 s of the driven arm by either scheme (0 iterations: rk4); how far its joints then are from where 2000
   short steps lead, by how far those lead. */
static double driven_step(fb_status *status, double torque, int iterations, int allow)
{
  double off = 0.0, way = 0.0;
  driven_arm(torque);
  desc.allow_long_step = allow;
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
  kept = state;
  *status = iterations ? fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, FB_R(0.1), iterations)
                       : fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(0.1));
  FBT_TRUE(*status == FB_OK || memcmp(&state, &kept, sizeof state) == 0);
  for (int k = 0; k < 2000; k++) {
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &kept, &work, &input, &input, &input, FB_R(0.1) / FB_R(2000.0)),
               FB_OK);
  }
  for (int k = 0; k < 3; k += 2) {
    off = fmax(off, fabs((double)(state.link[k].x[0] - kept.link[k].x[0])));
    way = fmax(way, fabs((double)(kept.link[k].x[0] - start[k].value[0])));
  }
  return off / way;
}

/* E11.24, E11.25: torques that lead an arm from rest to turn by radians within one step: Newton's iterations do not follow,
   and the step says so instead of giving what is off by a third; gentle ones go through, and are right. */
TEST(steps_that_have_not_converged_say_so)
{
  static const double gentle[] = {1.0, 8.0, 32.0}, wild[] = {512.0, 1024.0};
  fb_status status;
  for (int iterations = 2; iterations < 5; iterations++) {
    for (int k = 0; k < 3; k++) {
      FBT_BELOW(driven_step(&status, gentle[k], iterations, 1), 0.03);
      FBT_INT_EQ(status, FB_OK);
    }
    for (int k = 0; k < 2; k++) { /* 0.3 and more off where it was not asked */
      (void)driven_step(&status, wild[k], iterations, 1);
      FBT_INT_EQ(status, FB_ERR_CONVERGENCE);
    }
  }
}

/* A rod that turns and bends on a sled, which runs along x at a speed: its modes after 0.4 s; 0 where a step is refused. */
static int on_sled(fb_real q[3], double speed, double dt, int iterations)
{
  fb_status status = FB_OK;
  fresh();
  rigid(&model[0], 20.0, 0.0, 0.0, 0.0, 3.0, 3.0, 3.0);
  flexible(&model[1], 2, 1, 0, FB_EFFECTS_FULL);
  hang(0, 0, FB_JOINT_PRISMATIC, FB_GROUND, 0);
  turn(desc.joint[0].attitude, 0.0, 0.5 * pi, 0.0);
  turn(desc.joint[0].child_attitude, 0.0, 0.5 * pi, 0.0);
  hang(1, 1, FB_JOINT_REVOLUTE, 0, 0);
  start[0].speed[0] = (fb_real)speed;
  start[1].speed[0] = FB_R(2.0);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
  input.drive[1].torque[0] = FB_R(1.0);
  for (int k = 0; k < (int)(0.4 / dt + 0.5) && status == FB_OK; k++) {
    status = fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, (fb_real)dt, iterations);
  }
  memcpy(q, state.link[1].q, 3 * sizeof *q);
  return status == FB_OK;
}

/* E11.24, E11.25: on a sled that runs at up to 300 m/s two iterations either bend the rod as thirty do or say that they do
   not: what bends is judged by itself, for beside the way of the sled it is nothing. */
TEST(a_fast_sled_does_not_hide_what_bends)
{
  int taken = 0, refused = 0;
  for (int k = 0; k < 12; k++) {
    const double speed = 3.0 * pow(10.0, k % 3), dt = 1e-3 * pow(2.0, k / 3);
    fb_real q[3], fine[3];
    if (on_sled(q, speed, dt, 2)) {
      FBT_TRUE(on_sled(fine, speed, dt, 30));
      FBT_BELOW(fbt_difference(q, fine, 3), 0.02 * fbt_largest(fine, 3));
      taken++;
    } else {
      refused++;
    }
  }
  FBT_TRUE(taken > 2 && refused > 2);
}

/* E11.27, E11.28: a thin tube, 10 m long, as the only body of a system, tumbling with a little spin about its axis, in steps
   of a tenth of the limit: spin about the axis and energy stay, down to inertias of 1e-8 (single 1e-4) to one,
   but for rounding of L times what the thin axis makes of it. */
TEST(thin_tubes_keep_calm)
{
  for (int thin = 4; thin <= (FB_SINGLE ? 4 : 8); thin++) {
    const double It = 8.3, Ix = It * pow(10.0, -thin);
    double before, dt;
    fresh();
    rigid(&model[0], 1.0, 0.0, 0.0, 0.0, Ix, It, It);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    start[0].speed[3] = FB_R(0.01);
    start[0].speed[4] = FB_R(0.1);
    start[0].speed[5] = FB_R(0.02);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    before = energy_of(&state);
    dt = 0.1 * (double)fb_system_rk4_limit(&mechanism, model, FB_R(0.1), FB_R(0.0));
    for (int step = 0; step < 2000; step++) {
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, (fb_real)dt), FB_OK);
    }
    FBT_NEAR_REL(energy_of(&state), before, FBT_TOL(1e-12, 1e-4));
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    FBT_NEAR_REL(motion.motion[0].w[0], 0.01, FBT_TOL(1e-4, 0.5)); /* single: 16 roundings times 1e4 */
  }
}

/* E11.26: a step in which a body comes to turn by radians is refused by either scheme, though nothing turns at its start
   and no spring bounds it; half of that goes through, and is right. */
TEST(steps_that_turn_too_far_are_refused)
{
  for (int iterations = 0; iterations < 4; iterations += 3) {
    fb_status status;
    FBT_BELOW(driven_step(&status, 32.0, iterations, 0), 0.03);
    FBT_INT_EQ(status, FB_OK);
    (void)driven_step(&status, 200.0, iterations, 0);
    FBT_INT_EQ(status, FB_ERR_STEP);
  }
}

/* Particles with as many modes and nodes as there can be; all modes move and turn all nodes. */
static void crowded(fb_body *body)
{
  const int n = FB_MAX_MODES;
  fb_body_desc d = body_desc;
  fb_real r[3], psi[3 * FB_MAX_MODES], theta[3 * FB_MAX_MODES];
  int node;
  d.base = FB_BASE_PRESCRIBED;
  d.effects |= FB_EFFECTS_SPIN;
  d.deflection_limit = FB_R(10.0);
  FBT_INT_EQ(fb_shape_init(&shape, n), FB_OK);
  for (int k = 0; k < 2 * n; k++) {
    fbt_fill(r, 3, 1.0);
    fbt_fill(psi, 3 * n, 0.2);
    FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(0.3), r, psi, NULL), FB_OK);
  }
  for (int a = 0; a < n; a++) {
    shape.K[a * (n + 1)] = (fb_real)(5.0 + a);
  }
  for (int k = 1; k < FB_MAX_NODES; k++) {
    fbt_fill(r, 3, 1.0);
    fbt_fill(psi, 3 * n, 0.2);
    fbt_fill(theta, 3 * n, 0.2);
    FBT_INT_EQ(fb_shape_add_node(&shape, &node, r, psi, theta), FB_OK);
  }
  FBT_INT_EQ(fb_body_init(body, &body_work, &shape, &d), FB_OK);
}

/* E9.3 to E9.6, E9.10, E9.19: bodies with as many modes as there can be, on each other's nodes, by each method. */
TEST(methods_agree_on_as_many_modes_as_there_can_be)
{
  static fb_system_motion first;
  fresh();
  fbt_seed(13);
  crowded(&model[0]);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  hang(1, 0, FB_JOINT_UNIVERSAL, 0, 1);
  for (int k = 0; k < 2; k++) {
    fbt_fill(start[k].speed, k ? 2 : 6, 0.5);
    fbt_fill(start[k].q, model[0].n, 0.05);
    fbt_fill(start[k].q_dot, model[0].n, 0.2);
    start[k].value[0] = FB_R(0.3);
  }
  for (int method = 0; method < 3; method++) {
    init((fb_method)method);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, method ? &motion : &first, &state, NULL), FB_OK);
    FBT_BELOW(method ? motion_difference(&motion, &first) : 0.0, FBT_TOL(1e-10, 1e-2));
  }
}

/* E9.18, E9.19: accelerations are the rates of the velocities along the rates of the state, for all bodies, modes and
   joints, with motors, loads and prescribed axes. */
TEST(accelerations_are_the_rates_of_velocities)
{
  static fb_system_motion at, side;
  const double h = FBT_TOL(1e-4, 1e-2);
  fb_real v_dot[FB_MAX_BODIES][3];
  double worst = 0.0;
  tree(FB_EFFECTS_FULL, 1);
  drives();
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_rates(&mechanism, model, &work, &rate, &state, &input), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &at, &state, &input), FB_OK);
  for (int k = 0; k < desc.n_body; k++) {
    fb_vec3_cross(v_dot[k], at.motion[k].w, at.motion[k].v);
    for (int i = 0; i < 3; i++) {
      v_dot[k][i] = at.motion[k].acceleration[i] - v_dot[k][i];
    }
  }
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
        v_dot[k][i] -= (fb_real)(weight[s + 2] / h) * side.motion[k].v[i];
        at.motion[k].w_dot[i] -= (fb_real)(weight[s + 2] / h) * side.motion[k].w[i];
        at.joint[k].acceleration[i] -= (fb_real)(weight[s + 2] / h) * side.joint[k].speed[i];
      }
      for (int a = 0; a < model[desc.model[k]].n; a++) {
        at.motion[k].q_ddot[a] -= (fb_real)(weight[s + 2] / h) * side.motion[k].q_dot[a];
      }
    }
  }
  for (int k = 0; k < desc.n_body; k++) {
    worst = fmax(worst, fmax(fbt_largest(v_dot[k], 3), fbt_largest(at.motion[k].w_dot, 3)));
    worst = fmax(worst, fbt_largest(at.motion[k].q_ddot, model[desc.model[k]].n));
    worst = fmax(worst, fbt_largest(at.joint[k].acceleration, 3));
  }
  FBT_BELOW(worst, FBT_TOL(1e-8, 1e-2));
}

/* E11.12 to E11.14, E9.13: halving the step divides the error by 2^order, with all joints, eliminated or kept, motors,
   loads and prescribed axes; the reference is rk4 with a much shorter step. */
TEST(systems_converge_with_the_order_of_the_scheme)
{
  static fb_system_motion exact;
  for (int run = 0; run < 3; run++) { /* rk4 on the tree, rk4 with constraints, sdirk */
    double error[2];
    const double T = FBT_TOL(0.04, 0.16);
    tree(FB_EFFECTS_FULL, 1);
    drives();
    desc.allow_long_step = 1;
    init(FB_METHOD_RECURSIVE);
    stepped(&state, 320, T / 320);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &exact, &state, &input), FB_OK);
    for (int k = 0; k < 2; k++) {
      const int n = (run == 2 ? 40 : 10) << k;
      tree(FB_EFFECTS_FULL, 1);
      drives();
      desc.allow_long_step = 1;
      init(run == 1 ? FB_METHOD_MULTIPLIERS : FB_METHOD_RECURSIVE);
      implicit = run == 2 ? 4 : 0;
      stepped(&state, n, T / n);
      implicit = 0;
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
      error[k] = 0.0;
      for (int b = 0; b < desc.n_body; b++) {
        error[k] = fmax(error[k], fbt_difference(motion.motion[b].w, exact.motion[b].w, 3));
        error[k] = fmax(error[k], fbt_difference(motion.motion[b].v, exact.motion[b].v, 3));
      }
    }
    if (!FB_SINGLE) {
      FBT_NEAR_ABS(log2(error[0] / error[1]), run < 2 ? 4.0 : 2.0, 0.3);
    }
  }
}

/* E11.14: between the ends of a step inputs are linear: what they give a round body at rest is the mean of both times dt,
   forces momentum, torques and motors spin, prescribed rates path and turn, each in all its components. */
TEST(inputs_are_linear_between_the_ends_of_a_step)
{
  static const fb_real ramp[6] = {FB_R(0.3), FB_R(-0.5), FB_R(0.7), FB_R(0.2), FB_R(0.4), FB_R(-0.6)};
  static const double dt = 0.01;
  for (int what = 0; what < 3; what++) { /* loads, motors, prescribed rates */
    fb_system_input end;
    fb_real turned[3];
    fresh();
    rigid(&model[0], 2.0, 0, 0, 0, 0.5, 0.5, 0.5);
    hang(0, 0, what == 1 ? FB_JOINT_SPHERICAL : FB_JOINT_FREE, FB_GROUND, 0);
    if (what == 2) {
      desc.joint[0].mode[0] = FB_AXIS_PRESCRIBED;
    }
    input.n_load = what == 0;
    end = input;
    for (int i = 0; i < 3; i++) { /* three times as much at the end, along the same line: the mean is twice */
      const fb_real a = ramp[i], b = ramp[3 + i];
      input.load[0].load.force[i] = what == 0 ? a : FB_R(0.0);
      input.load[0].load.torque[i] = what == 0 ? b : FB_R(0.0);
      input.drive[0].torque[i] = what == 1 ? b : FB_R(0.0);
      input.drive[0].rate[i] = what == 2 ? b : FB_R(0.0); /* along the axis that it turns about */
      input.drive[0].rate[3 + i] = what == 2 ? b : FB_R(0.0);
      end.load[0].load.force[i] = 3 * input.load[0].load.force[i];
      end.load[0].load.torque[i] = 3 * input.load[0].load.torque[i];
      end.drive[0].torque[i] = 3 * input.drive[0].torque[i];
      end.drive[0].rate[i] = 3 * input.drive[0].rate[i];
      end.drive[0].rate[3 + i] = 3 * input.drive[0].rate[3 + i];
    }
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &end, (fb_real)dt, 4), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &end), FB_OK);
    fb_quat_to_rotvec(turned, motion.pose[0].quat);
    for (int i = 0; i < 3; i++) {
      if (what == 2) {
        FBT_NEAR_REL(motion.pose[0].rho[i], 2.0 * (double)ramp[3 + i] * dt, FBT_TOL(1e-5, 1e-4));
        FBT_NEAR_REL(turned[i], 2.0 * (double)ramp[3 + i] * dt, FBT_TOL(1e-5, 1e-4)); /* turns are of order two */
      } else {
        FBT_NEAR_ABS(motion.motion[0].v[i], what == 0 ? 2.0 * (double)ramp[i] * dt / 2.0 : 0.0, FBT_TOL(1e-6, 1e-5));
        FBT_NEAR_REL(motion.motion[0].w[i], 2.0 * (double)ramp[3 + i] * dt / 0.5, FBT_TOL(1e-9, 1e-4));
      }
    }
  }
}

/* Holds x of body 0; user: the earliest and the latest time asked for. */
static int times_seen(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  double *const seen = (double *)user;
  (void)pose, (void)capacity;
  seen[0] = fmin(seen[0], (double)t);
  seen[1] = fmax(seen[1], (double)t);
  row[0].body[1] = FB_GROUND;
  row[0].force[0][0] = FB_R(1.0);
  return 1;
}

/* E11.14: the caller's constraints are asked for at times within the step. */
TEST(constraints_are_asked_for_within_the_step)
{
  double seen[2] = {1e9, -1e9};
  fb_system_input end;
  fresh();
  rigid(&model[0], 2.0, 0, 0, 0, 0.5, 0.5, 0.5);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  input.rows = times_seen;
  input.user = seen;
  input.t = FB_R(8.0);
  end = input;
  end.t = FB_R(8.25);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &end, FB_R(0.25), 0), FB_OK);
  FBT_NEAR_ABS(seen[0], 8.0, FBT_TOL(1e-4, 1e-2)); /* rates by differences */
  FBT_NEAR_ABS(seen[1], 8.25, FBT_TOL(1e-4, 1e-2));
}

/* E9.15 on p10: free tops, rates and attitude. */
TEST(tops_follow_the_references)
{
  static const char *const file[] = {"p10_asymmetric_top.csv", "p10_symmetric_top.csv"};
  static const char *const column[] = {"w1", "w2", "w3", "q0", "q1", "q2", "q3"};
  for (int top = 0; top < 2; top++) {
    for (int joint = 0; joint < 2; joint++) { /* free, and on a spherical joint */
      const fbt_table *table = fbt_reference(file[top]);
      const int n = 2000;
      double worst = 0.0;
      fresh();
      rigid(&model[0], 1.0, 0, 0, 0, top ? 2 : 1, 2, 3);
      hang(0, 0, joint ? FB_JOINT_SPHERICAL : FB_JOINT_FREE, FB_GROUND, 0);
      for (int i = 0; i < 3; i++) {
        start[0].speed[joint ? i : 3 + i] = (fb_real)fbt_value(table, 0, column[i]);
      }
      init(FB_METHOD_RECURSIVE);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
      for (int row = 1; row < (FB_SINGLE ? 11 : 21); row++) { /* about the middle axis errors grow */
        double sign = 0.0;
        for (int k = 0; k < n; k++) {
          FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, FB_R(1.0) / (fb_real)n),
                     FB_OK);
        }
        FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
        for (int i = 0; i < 4; i++) {
          sign += (double)state.link[0].quat[i] * fbt_value(table, row, column[3 + i]);
        }
        for (int i = 0; i < 7; i++) {
          const double got =
              i < 3 ? (double)motion.motion[0].w[i] : (double)state.link[0].quat[i - 3] * (sign < 0 ? -1 : 1);
          worst = fmax(worst, fabs(got - fbt_value(table, row, column[i])));
        }
      }
      FBT_BELOW(worst, FBT_TOL(1e-8, 4e-3));
      fbt_figure(joint ? "top on a spherical joint, rates and attitude" : "free top, rates and attitude", file[top],
                 worst);
    }
  }
}

/* E11.22: as bodies alone: a position far away that moves by less than its rounding, a hinge that turns by 1e-9 rad a
   step. */
TEST(systems_lose_nothing_by_short_steps)
{
  for (implicit = 0; implicit < 3; implicit += 2) {
    const double dt = 1e-4;
    const int n = 20000;
    fresh();
    rigid(&model[0], 2.0, 0, 0, 0, 1, 2, 3);
    rigid(&model[1], 1.0, 0, 0, 0, 1, 1, 1);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    hang(1, 1, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    start[0].value[0] = FB_R(7e6);
    start[0].speed[0] = FB_R(3.0);
    start[1].value[0] = FB_R(1.0);
    start[1].speed[0] = FB_R(1e-5);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    for (int k = 0; k < n; k++) {
      FBT_INT_EQ(implicit ? fb_system_sdirk_step(&mechanism, model, &state, &work, NULL, NULL, (fb_real)dt, implicit)
                          : fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, (fb_real)dt),
                 FB_OK);
    }
    FBT_NEAR_ABS(state.link[0].x[0] - FB_R(7e6), 3.0 * dt * n, FBT_TOL(1e-4, 0.51));
    FBT_NEAR_ABS(state.link[1].x[0] - FB_R(1.0), 1e-5 * dt * n, FBT_TOL(1e-9, 1.3e-7));
  }
  implicit = 0;
}

/* Rates of the planar pendulum of n uniform rods, the last of mass `last`, the others of 1 kg, from its mass matrix by
   elimination: angles from the vertical. */
static void pendulum_rates(double *dx, const double *x, int n, double last)
{
  double A[8][9];
  for (int i = 0; i < n; i++) {
    double rhs = -9.81 * (i < n - 1 ? n - 2 - i + last + 0.5 : 0.5 * last) * sin(x[i]);
    for (int j = 0; j < n; j++) {
      const int outer = i > j ? i : j;
      const double own = outer < n - 1 ? 1.0 : last, beyond = outer < n - 1 ? n - 2 - outer + last : 0.0;
      const double c = own * (i == j ? 1.0 / 3.0 : 0.5) + beyond;
      A[i][j] = c * cos(x[i] - x[j]);
      rhs -= i == j ? 0.0 : c * sin(x[i] - x[j]) * x[n + j] * x[n + j];
    }
    A[i][n] = rhs;
  }
  for (int p = 0; p < n; p++) {
    for (int r = 0; r < n; r++) {
      const double f = A[r][p] / A[p][p];
      for (int c = p; c <= n && r != p; c++) {
        A[r][c] -= f * A[p][c];
      }
    }
  }
  for (int i = 0; i < n; i++) {
    dx[i] = x[n + i];
    dx[n + i] = A[i][n] / A[i][i];
  }
}

/* E9.2 to E9.5, E9.14: the pendulum of one to six rods against its own equations in absolute angles, both with rk4 at a
   step whose error is far below. */
TEST(pendulums_of_rods_follow_their_equations)
{
  body_desc.effects = FB_EFFECT_GRAVITY;
  for (int n = 1; n <= 6; n++) {
    double x[16] = {0}, worst = 0.0, angle = 0.0;
    const double dt = FBT_TOL(1e-4, 1e-3);
    fresh();
    body_desc.effects = FB_EFFECT_GRAVITY;
    body_desc.gravity[1] = -FB_R(9.81);
    rigid(&model[0], 1.0, 0, -0.5, 0, 1.0 / 12.0, 0, 1.0 / 12.0);
    for (int k = 0; k < n; k++) {
      hang(k, 0, FB_JOINT_REVOLUTE, k - 1, k > 0);
      x[k] = 0.3 + 0.2 * k;
      start[k].value[0] = (fb_real)(k > 0 ? 0.2 : 0.3);
    }
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    for (int step = 0; step < FBT_TOL(10000, 500); step++) {
      double k1[16], k2[16], k3[16], k4[16], y[16];
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, (fb_real)dt), FB_OK);
      pendulum_rates(k1, x, n, 1.0);
      for (int i = 0; i < 2 * n; i++) {
        y[i] = x[i] + 0.5 * dt * k1[i];
      }
      pendulum_rates(k2, y, n, 1.0);
      for (int i = 0; i < 2 * n; i++) {
        y[i] = x[i] + 0.5 * dt * k2[i];
      }
      pendulum_rates(k3, y, n, 1.0);
      for (int i = 0; i < 2 * n; i++) {
        y[i] = x[i] + dt * k3[i];
      }
      pendulum_rates(k4, y, n, 1.0);
      for (int i = 0; i < 2 * n; i++) {
        x[i] += dt / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
      }
    }
    for (int k = 0; k < n; k++) {
      angle += (double)state.link[k].x[0];
      worst = fmax(worst, fabs(angle - x[k]));
    }
    FBT_BELOW(worst, FBT_TOL(1e-8, 2e-2));
    if (n == 6) {
      fbt_figure("pendulum of six rods, angles after 1 s [rad]", "equations in absolute angles", worst);
    }
  }
}

/* E9.4, E9.14, E12.8 to E12.10: Hopkins' gimbal, three revolute joints with two massless rings on a turntable: from a
   guess aside it comes back to where its torques hold it; the eigenvalues there. */
TEST(gimbal_has_the_published_eigenvalues)
{
  static const double I[2][6] = {{4, 5, 6, 0.3, -0.2, 0.1}, {2, 3, 4.5, 0, 0, 0}};
  static const double spin[2][3] = {{0.5, 0.8, 1.2}, {0, 0, 3}}, K[2][3] = {{30, 40, 50}, {20, 15, 10}};
  const fbt_table *table = fbt_reference("p09_gimbal.csv");
  for (int set = 0; set < 2; set++) {
    const fb_real center[3] = {0};
    fb_real inertia[6];
    double worst = 0.0;
    fresh();
    for (int i = 0; i < 6; i++) {
      inertia[i] = (fb_real)I[set][i];
    }
    body_desc.base = FB_BASE_PRESCRIBED;
    rigid(&model[0], 0.0, 0, 0, 0, 0, 0, 0);
    FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(1.0), center, inertia), FB_OK);
    FBT_INT_EQ(fb_body_init(&model[1], &body_work, &shape, &body_desc), FB_OK);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0); /* the base, spun */
    desc.joint[0].mode[0] = FB_AXIS_PRESCRIBED;
    for (int k = 1; k < 4; k++) { /* about x, y, z of the base: the joint's z axis there, and back on the child */
      hang(k, k == 3, FB_JOINT_REVOLUTE, k - 1, 0);
      turn(desc.joint[k].attitude, k == 2 ? -pi / 2 : 0.0, k == 1 ? pi / 2 : 0.0, 0.0);
      memcpy(desc.joint[k].child_attitude, desc.joint[k].attitude, sizeof desc.joint[k].attitude);
      desc.joint[k].stiffness[0] = (fb_real)K[set][k - 1];
    }
    for (int i = 0; i < 3; i++) {
      input.drive[0].rate[3 + i] = (fb_real)spin[set][i];
      start[0].speed[3 + i] = (fb_real)spin[set][i];
    }
    { /* steady torques of the springs: T = W x I W */
      const double *w = spin[set], *J = I[set];
      const double h[3] = {J[0] * w[0] + J[3] * w[1] + J[4] * w[2], J[3] * w[0] + J[1] * w[1] + J[5] * w[2],
                           J[4] * w[0] + J[5] * w[1] + J[2] * w[2]};
      input.drive[1].torque[0] = (fb_real)(w[1] * h[2] - w[2] * h[1]);
      input.drive[2].torque[0] = (fb_real)(w[2] * h[0] - w[0] * h[2]);
      input.drive[3].torque[0] = (fb_real)(w[0] * h[1] - w[1] * h[0]);
    }
    for (int k = 1; k < 4; k++) {
      start[k].value[0] = (fb_real)(0.1 * k - 0.15);
    }
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_trim(&mechanism, model, &state, &analyse_work, &input), FB_OK);
    for (int k = 1; k < 4; k++) {
      FBT_NEAR_ABS(state.link[k].x[0], 0.0, FBT_TOL(1e-14, 1e-6));
    }
    FBT_INT_EQ(fb_system_spectrum(&spectrum, &analyse_work, &mechanism, model, &state, &input), FB_OK);
    FBT_INT_EQ(spectrum.n, 3);
    for (int row = 0, k = 0; row < table->rows; row++) {
      if (strcmp(fbt_word(table, row, "set"), set ? "B" : "A") == 0 &&
          strcmp(fbt_word(table, row, "quantity"), "eig_im") == 0 && fbt_value(table, row, "value") > 0.0) {
        worst = fmax(worst, fabs((double)spectrum.im[k] - fbt_value(table, row, "value")));
        worst = fmax(worst, fabs((double)spectrum.re[k++]));
      }
    }
    FBT_BELOW(worst, FBT_TOL(1e-9, 1e-3));
    fbt_figure("gimbal on a turntable, eigenvalues [rad/s]", "p09_gimbal.csv", worst);
  }
}

/* A joint that closes a loop. */
static fb_joint_desc *close_loop(fb_joint_kind kind, int parent, int parent_node, int child, int child_node)
{
  fb_joint_desc *j = &desc.loop[desc.n_loop++];
  j->kind = kind;
  j->parent = parent;
  j->parent_node = parent_node;
  j->child = child;
  j->child_node = child_node;
  return j;
}

/* A planar four-bar of rigid rods along x, ground from 0 to d: crank a, coupler b, rocker c; in three dimensions with
   revolute joints, so that three of the five rows that close it are redundant. */
static void fourbar(double a, double b, double c, double d, fb_joint_kind closing)
{
  const double length[3] = {a, b, c};
  fresh();
  for (int k = 0; k < 3; k++) {
    const double l = length[k];
    rigid(&model[k], l, 0.5 * l, 0, 0, 0.01 * l * l * l, l * l * l / 12.0, l * l * l / 12.0);
  }
  hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
  hang(1, 1, FB_JOINT_REVOLUTE, 0, 1);
  hang(2, 2, FB_JOINT_REVOLUTE, FB_GROUND, 0);
  desc.joint[2].position[0] = (fb_real)d;
  close_loop(closing, 1, 1, 2, 1);
}

/* Rocker angle of a four-bar at the crank angle, the branch with the loop uncrossed. */
static double rocker_angle(double a, double b, double c, double d, double crank)
{
  const double x = a * cos(crank) - d, y = a * sin(crank), r2 = x * x + y * y, r = sqrt(r2);
  const double cosine = (r2 + c * c - b * b) / (2.0 * r * c);
  return atan2(y, x) - acos(cosine);
}

/* E9.8 to E9.10, E9.17: a four-bar driven round by its crank: the rocker is where the closed form says, the loop stays
   closed and redundant rows do no harm; also with the crank free, where energy stays. */
TEST(redundant_loops_are_accepted)
{
  const double a = 0.4, b = 1.0, c = 0.8, d = 1.1, spin = 3.0, start_angle = 0.7;
  for (int run = 0; run < 4; run++) { /* closing joint: revolute or spherical; crank driven or free */
    const double dt = FBT_TOL(1e-3, 2e-3), first = rocker_angle(a, b, c, d, start_angle);
    double worst = 0.0, closure = 0.0, before, after;
    fb_system_input middle;
    fourbar(a, b, c, d, run % 2 ? FB_JOINT_SPHERICAL : FB_JOINT_REVOLUTE);
    desc.method = FB_METHOD_RECURSIVE;
    start[0].value[0] = (fb_real)start_angle;
    start[2].value[0] = (fb_real)(first + 0.02); /* is closed from nearby */
    start[1].value[0] =
        (fb_real)(atan2(c * sin(first) - a * sin(start_angle), d + c * cos(first) - a * cos(start_angle)) -
                  start_angle);
    start[0].speed[0] = (fb_real)spin;
    if (run < 2) {
      desc.joint[0].mode[0] = FB_AXIS_PRESCRIBED;
      input.drive[0].value[0] = (fb_real)start_angle;
      input.drive[0].rate[0] = (fb_real)spin;
    }
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    before = energy_of(&state);
    middle = input;
    for (int step = 1; step <= 2500; step++) {
      middle.drive[0].value[0] = (fb_real)(start_angle + spin * dt * (step - 0.5));
      input.drive[0].value[0] = (fb_real)(start_angle + spin * dt * step);
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &middle, &input, (fb_real)dt), FB_OK);
      if (step % 50 == 0) {
        const double crank = (double)state.link[0].x[0], rocker = rocker_angle(a, b, c, d, crank);
        const double x =
            a * cos(crank) + b * cos(crank + (double)state.link[1].x[0]) - d - c * cos((double)state.link[2].x[0]);
        const double y =
            a * sin(crank) + b * sin(crank + (double)state.link[1].x[0]) - c * sin((double)state.link[2].x[0]);
        worst = fmax(worst, fabs(remainder((double)state.link[2].x[0] - rocker, 2.0 * pi)));
        closure = fmax(closure, hypot(x, y));
      }
    }
    after = energy_of(&state);
    FBT_BELOW(worst, FBT_TOL(1e-10, 1e-4));
    FBT_BELOW(closure, FBT_TOL(1e-12, 1e-5));
    FBT_INT_EQ(work.rank, 2);
    if (run >= 2) {
      FBT_NEAR_REL(after, before, FBT_TOL(1e-9, 1e-3));
    } else {
      fbt_figure("driven four-bar, rocker angle [rad]", "closed form", worst);
    }
  }
}

/* A crank of length a, a rod of length b and a slider on the ground's x axis; a loop closes the pin of the slider. */
static void slider_crank(double a, double b)
{
  fourbar(a, b, b, 0.0, FB_JOINT_REVOLUTE);
  hang(2, 2, FB_JOINT_PRISMATIC, FB_GROUND, 0);
  turn(desc.joint[2].attitude, 0, 0.5 * pi, 0);
  turn(desc.joint[2].child_attitude, 0, 0.5 * pi, 0);
  desc.loop[0].child_node = 0;
}

/* The linkage on ground that is turned: what hangs on it. */
static void tilt_ground(double x, double y, double z)
{
  fb_real tilt[4], R[9];
  turn(tilt, x, y, z);
  fb_quat_to_mat33(R, tilt);
  for (int k = 0; k < desc.n_body; k++) {
    fb_joint_desc *j = &desc.joint[k];
    if (j->parent == FB_GROUND) {
      const fb_real none[4] = {FB_R(1.0)}, position[3] = {j->position[0], j->position[1], j->position[2]};
      const int turned = j->attitude[0] > FB_R(0.0);
      fb_real attitude[4];
      memcpy(attitude, turned ? j->attitude : none, sizeof attitude);
      fb_quat_mul(j->attitude, tilt, attitude);
      fb_mat33_mul_vec3(j->position, R, position);
    }
  }
}

/* E12.11: a linkage with a spring at its crank, in any plane, swings with k/(2 T) of a crank that turns with 1 rad/s, and
   with as many periods a second whatever the unit of length; redundant rows come first or last. */
TEST(linkages_swing_alike_in_any_unit_of_length)
{
  for (int run = 0; run < 9; run++) {
    const int slides = run / 3 == 2;
    const double unit = pow(1e3, run % 3 - 1), a = 0.4, b = 1.0, c = 0.8, d = 1.1, crank = 0.7;
    const double rocker = rocker_angle(a, b, c, d, crank), stiffness = 20.0 * unit * unit * unit;
    const double rod = slides ? -asin(a * sin(crank) / b)
                              : atan2(c * sin(rocker) - a * sin(crank), d + c * cos(rocker) - a * cos(crank));
    double speed;
    fb_energy energy;
    if (slides) {
      slider_crank(a * unit, b * unit);
    } else {
      fourbar(a * unit, b * unit, c * unit, d * unit, run / 3 ? FB_JOINT_SPHERICAL : FB_JOINT_REVOLUTE);
    }
    turn(desc.loop[0].attitude, run / 3 == 1 ? 0.5 * pi : 0.0, 0, 0);
    tilt_ground(0.4, -0.7, 0.3);
    desc.joint[0].stiffness[0] = (fb_real)stiffness;
    desc.joint[0].rest[0] = start[0].value[0] = (fb_real)crank;
    start[1].value[0] = (fb_real)(rod - crank);
    start[2].value[0] = (fb_real)(slides ? unit * (a * cos(crank) + b * cos(rod)) : rocker);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_spectrum(&spectrum, &analyse_work, &mechanism, model, &state, NULL), FB_OK);
    start[0].speed[0] = FB_R(1.0);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_energy(&mechanism, model, &work, &energy, &state, NULL), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    speed = (double)motion.joint[0].speed[0];
    FBT_INT_EQ(spectrum.n, 1);
    FBT_NEAR_REL(spectrum.im[0], sqrt(stiffness * speed * speed / (2.0 * (double)energy.kinetic)), FBT_TOL(1e-8, 1e-3));
  }
}

/* E9.11: two bodies on one axis, each on springs, dampers and motors, or just one of these, of two joints of the tree
   and of two that close loops, forwards and backwards: their accelerations, the power and the energy as Newton and
   Hooke have it. */
TEST(springs_of_loops_pull_like_those_of_the_tree)
{
  static const int child[4] = {0, 1, 1, 0}, parent[4] = {-1, 0, -1, 1}; /* joints, then loops */
  static const double k_of[4] = {3.0, 5.0, 7.0, 11.0}, c_of[4] = {0.3, 0.2, 0.5, 0.7}, rest[4] = {0.2, -0.1, 0.3, 0.15};
  static const double motor_of[4] = {1.0, -2.0, 1.5, 0.7}, angle[2] = {0.4, 0.9}, rate_of[2] = {1.3, -0.8}, mass = 2.0;
  for (int run = 0; run < 12; run++) {
    const int method = run % 3, only = run / 3; /* all, springs, dampers, motors */
    const double inertia[2] = {0.6 + mass * 0.09, 0.9};
    double torque[2] = {0.0, 0.0}, power = 0.0, strain = 0.0;
    fb_energy energy;
    fresh();
    rigid(&model[0], mass, 0.3, 0, 0, 0.4, 0.5, 0.6);
    rigid(&model[1], mass, 0, 0, 0.2, 0.7, 0.8, 0.9);
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    hang(1, 1, FB_JOINT_REVOLUTE, 0, 0);
    close_loop(FB_JOINT_REVOLUTE, FB_GROUND, 0, 1, 0);
    close_loop(FB_JOINT_REVOLUTE, 1, 0, 0, 0);
    for (int j = 0; j < 4; j++) {
      fb_joint_desc *joint = j < 2 ? &desc.joint[j] : &desc.loop[j - 2];
      const double value = angle[child[j]] - (parent[j] < 0 ? 0.0 : angle[parent[j]]);
      const double speed = rate_of[child[j]] - (parent[j] < 0 ? 0.0 : rate_of[parent[j]]);
      const double k = only < 2 ? k_of[j] : 0.0, c = only % 2 ? 0.0 : c_of[j];
      const double motor = only % 3 ? 0.0 : motor_of[j];
      const double tau = motor - k * (value - rest[j]) - c * speed;
      joint->stiffness[0] = (fb_real)k;
      joint->damping[0] = (fb_real)c;
      joint->rest[0] = (fb_real)rest[j];
      input.drive[j].torque[0] = (fb_real)motor;
      if (j < 2) {
        start[j].value[0] = (fb_real)value;
        start[j].speed[0] = (fb_real)speed;
      }
      torque[child[j]] += tau;
      if (parent[j] >= 0) {
        torque[parent[j]] -= tau;
      }
      power += motor * speed;
      strain += 0.5 * k * (value - rest[j]) * (value - rest[j]);
    }
    init((fb_method)method);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    FBT_INT_EQ(fb_system_energy(&mechanism, model, &work, &energy, &state, &input), FB_OK);
    for (int i = 0; i < 2; i++) {
      FBT_NEAR_REL(motion.motion[i].w_dot[2], torque[i] / inertia[i], FBT_TOL(1e-12, 1e-5));
    }
    FBT_NEAR_REL(motion.power, power, FBT_TOL(1e-12, 1e-5));
    FBT_NEAR_REL(energy.strain, strain, FBT_TOL(1e-12, 1e-5));
  }
}

/* E9.11: a ball joint has one spring and one damper, the first ones, whose rest is zero: on a round body they give the
   rate -(k phi + c w)/J about all axes and the energy k phi^2/2, also as a loop. */
TEST(a_ball_joint_has_one_spring_and_one_damper)
{
  const double k = 3.0, c = 0.5, J = 0.7, phi[3] = {0.3, -0.5, 0.4};
  for (int form = 0; form < 4; form++) {
    fb_energy energy;
    fb_joint_desc *j;
    fresh();
    rigid(&model[0], 2.0, 0, 0, 0, J, J, J);
    hang(0, 0, form < 3 ? FB_JOINT_SPHERICAL : FB_JOINT_FREE, FB_GROUND, 0);
    j = form < 3 ? &desc.joint[0] : close_loop(FB_JOINT_SPHERICAL, FB_GROUND, 0, 0, 0);
    j->stiffness[0] = (fb_real)k;
    j->damping[0] = (fb_real)c;
    fbt_fill(j->rest, 3, 1.0);
    for (int i = 1; i < 3; i++) {
      j->stiffness[i] = j->damping[i] = FB_R(9.0);
    }
    turn(start[0].quat, phi[0], phi[1], phi[2]);
    fbt_fill(start[0].speed + (form < 3 ? 0 : 3), 3, 1.0);
    init(form < 3 ? (fb_method)form : FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    FBT_INT_EQ(fb_system_energy(&mechanism, model, &work, &energy, &state, NULL), FB_OK);
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(motion.motion[0].w_dot[i], -(k * phi[i] + c * (double)motion.motion[0].w[i]) / J,
                   FBT_TOL(1e-14, 1e-5));
    }
    FBT_NEAR_REL(energy.strain, 0.5 * k * 0.5, FBT_TOL(1e-14, 1e-5)); /* phi.phi is 0.5 */
  }
}

/* A body on a joint of that kind at the tip of another, both bend: turned frames, springs, dampers, motors, a load, in
   motion; one axis may be given. */
static void couple(fb_joint_kind kind, int axis, fb_axis_mode mode)
{
  fb_joint_desc *j = &desc.joint[1];
  fresh();
  flexible(&model[0], 1, 1, 1, FB_EFFECTS_FULL);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  hang(1, 0, kind, 0, 1);
  fbt_seed(5);
  turn_anyhow(j->attitude, 1.0);
  turn_anyhow(j->child_attitude, 1.0);
  fbt_fill(j->position, 3, 0.2);
  fbt_fill(j->child_position, 3, 0.2);
  fbt_fill(j->rest, 3, 0.2);
  j->pitch = FB_R(0.1);
  j->mode[axis] = mode;
  for (int i = 0; i < 3; i++) {
    j->stiffness[i] = (fb_real)(2.0 + fbt_random());
    j->damping[i] = (fb_real)(0.3 + 0.2 * fbt_random());
  }
  for (int k = 0; k < 2; k++) {
    fbt_fill(start[k].value, 3, 0.4);
    turn_anyhow(start[k].quat, 0.6);
    fbt_fill(start[k].speed, 6, 1.0);
    fbt_fill(start[k].q, model[0].n, 0.02);
    fbt_fill(start[k].q_dot, model[0].n, 0.2);
  }
  for (int i = 0; i < 3; i++) {
    input.drive[1].torque[i] = (fb_real)fbt_random();
    input.drive[1].value[i] = start[1].value[i];
    input.drive[1].rate[i] = start[1].speed[i];
    input.drive[1].acceleration[i] = (fb_real)fbt_random();
  }
  input.n_load = 1;
  input.load[0].body = 1;
  input.load[0].load.node = 1;
  fbt_fill(input.load[0].load.force, 3, 1.0);
  fbt_fill(input.load[0].load.torque, 3, 0.2);
}

/* The same, both bodies free where `at` has them, the joint closes a loop; backwards: from the second body to the
   first, all coordinates with the other sign. */
static void couple_by_a_loop(const fb_system_motion *at, int backwards)
{
  const fb_joint_desc joint = desc.joint[1];
  const fb_real sign = backwards ? FB_R(-1.0) : FB_R(1.0);
  fb_joint_desc *loop = close_loop(joint.kind, backwards, !backwards, !backwards, backwards);
  const int parent = loop->parent, node = loop->parent_node, child = loop->child, child_node = loop->child_node;
  *loop = joint;
  loop->parent = parent;
  loop->parent_node = node;
  loop->child = child;
  loop->child_node = child_node;
  if (backwards) {
    memcpy(loop->position, joint.child_position, sizeof loop->position);
    memcpy(loop->attitude, joint.child_attitude, sizeof loop->attitude);
    memcpy(loop->child_position, joint.position, sizeof loop->position);
    memcpy(loop->child_attitude, joint.attitude, sizeof loop->attitude);
  }
  for (int i = 0; i < 3; i++) {
    const fb_drive *d = &input.drive[1];
    loop->rest[i] *= sign;
    input.drive[2].torque[i] = sign * d->torque[i];
    input.drive[2].value[i] = sign * d->value[i];
    input.drive[2].rate[i] = sign * d->rate[i];
    input.drive[2].acceleration[i] = sign * d->acceleration[i];
  }
  memset(&input.drive[1], 0, sizeof input.drive[1]);
  memset(&desc.joint[1], 0, sizeof desc.joint[1]);
  memcpy(start[1].value, at->pose[1].rho, sizeof start[1].value);
  memcpy(start[1].quat, at->pose[1].quat, sizeof start[1].quat);
  memcpy(start[1].speed, at->motion[1].v, sizeof at->motion[1].v);
  memcpy(start[1].speed + 3, at->motion[1].w, sizeof at->motion[1].w);
}

/* The input t after the instant of `input`: accelerations are constant. */
static fb_system_input driven(double t)
{
  fb_system_input later = input;
  for (int j = 0; j < 3; j++) {
    for (int i = 0; i < 3; i++) {
      fb_drive *d = &later.drive[j];
      d->value[i] += (fb_real)t * d->rate[i] + (fb_real)(0.5 * t * t) * d->acceleration[i];
      d->rate[i] += (fb_real)t * d->acceleration[i];
    }
  }
  return later;
}

/* Motion of a couple, its joint j as number 1, backwards with the other sign, and of the whole the power, that of the
   motors, the energy; whatever the scratch held before. */
static void couple_eval(fb_system_motion *at, fb_real whole[3], int j, int backwards)
{
  fb_energy energy;
  memset(&work, 0xff, sizeof work);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, at, &state, &input), FB_OK);
  memset(&work, 0xff, sizeof work);
  FBT_INT_EQ(fb_system_rates(&mechanism, model, &work, &rate, &state, &input), FB_OK);
  FBT_INT_EQ(fb_system_energy(&mechanism, model, &work, &energy, &state, &input), FB_OK);
  whole[0] = at->power;
  whole[1] = rate.motor_work;
  whole[2] = energy.kinetic + energy.strain;
  at->joint[1] = at->joint[j];
  for (int i = 0; i < 3 && backwards; i++) {
    fb_joint_motion *joint = &at->joint[1];
    joint->value[i] *= FB_R(-1.0);
    joint->speed[i] *= FB_R(-1.0);
    joint->drive[i] *= FB_R(-1.0);
  }
}

/* x times s, n numbers */
static void multiply(fb_real *x, int n, double s)
{
  for (int i = 0; i < n; i++) {
    x[i] *= (fb_real)s;
  }
}

/* Unit of axis i of a joint: of a length, or 1. */
static double unit_of(fb_joint_kind kind, int i)
{
  return kind == FB_JOINT_PRISMATIC || (kind == FB_JOINT_CYLINDRICAL && i == 1) || (kind == FB_JOINT_FREE && i < 3)
             ? meter
             : 1.0;
}

/* From SI to the units: a joint, how it starts and what drives it. */
static void joint_in_units(fb_joint_desc *j, fb_link_motion *m, fb_drive *d)
{
  const double torque = kilogram * pow(meter / second, 2.0), hertz = 1.0 / second;
  multiply(j->position, 3, meter);
  multiply(j->child_position, 3, meter);
  multiply(&j->pitch, 1, meter);
  for (int i = 0; i < 6; i++) {
    const double length = unit_of(j->kind, i);
    multiply(&m->speed[i], 1, length * hertz);
    multiply(&d->rate[i], 1, length * hertz);
    multiply(&d->acceleration[i], 1, length * hertz * hertz);
    if (i < 3) {
      multiply(&m->value[i], 1, length);
      multiply(&d->value[i], 1, length);
      multiply(&d->torque[i], 1, torque / length);
      multiply(&j->rest[i], 1, length);
      multiply(&j->stiffness[i], 1, torque / (length * length));
      multiply(&j->damping[i], 1, torque * second / (length * length));
    }
  }
  multiply(m->q, FB_MAX_MODES, sqrt(kilogram) * meter);
  multiply(m->q_dot, FB_MAX_MODES, sqrt(kilogram) * meter * hertz);
}

static void system_in_units(void)
{
  fb_link_motion none;
  memset(&none, 0, sizeof none);
  for (int j = 0; j < desc.n_body + desc.n_loop; j++) {
    const int loop = j - desc.n_body;
    joint_in_units(loop < 0 ? &desc.joint[j] : &desc.loop[loop], loop < 0 ? &start[j] : &none, &input.drive[j]);
  }
  for (int i = 0; i < input.n_load; i++) {
    multiply(input.load[i].load.force, 3, kilogram * meter / (second * second));
    multiply(input.load[i].load.torque, 3, kilogram * pow(meter / second, 2.0));
  }
}

/* What motion_difference compares, back to SI. */
static void motion_in_si(fb_system_motion *all)
{
  const double force = kilogram * meter / (second * second), q = sqrt(kilogram) * meter;
  for (int k = 0; k < desc.n_body; k++) {
    fb_motion *m = &all->motion[k];
    multiply(all->pose[k].rho, 3, 1.0 / meter);
    multiply(all->pose[k].q, FB_MAX_MODES, 1.0 / q);
    multiply(m->v, 3, second / meter);
    multiply(m->w, 3, second);
    multiply(m->q_dot, FB_MAX_MODES, second / q);
    multiply(m->acceleration, 3, second * second / meter);
    multiply(m->w_dot, 3, second * second);
    multiply(m->q_ddot, FB_MAX_MODES, second * second / q);
    multiply(m->reaction_force, 3, 1.0 / force);
    multiply(m->reaction_torque, 3, 1.0 / (force * meter));
    multiply(all->joint[k].force, 3, 1.0 / force);
    multiply(all->joint[k].torque, 3, 1.0 / (force * meter));
    for (int i = 0; i < 3; i++) {
      const double length = unit_of(desc.joint[k].kind, i);
      multiply(&all->joint[k].speed[i], 1, second / length);
      multiply(&all->joint[k].drive[i], 1, length / (force * meter));
    }
  }
}

/* How the tree (by a method) or a pair of bodies (a kind of joint that closes a loop; where it has them: at) moves in
   the units that are set, in SI; and power, energy, momentum, longest step. */
static void motion_in_units(fb_system_motion *out, double whole[5], int method, int kind, const fb_system_motion *at)
{
  const double joule = kilogram * pow(meter / second, 2.0);
  fb_energy energy;
  fb_momentum momentum;
  if (at) {
    couple((fb_joint_kind)kind, 0, FB_AXIS_FREE);
    couple_by_a_loop(at, 0);
  } else {
    tree(FB_EFFECTS_FULL, 1);
    drives();
  }
  system_in_units();
  init((fb_method)method);
  memset(&work, 0xff, sizeof work); /* what is in it means nothing */
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
  if (!at) {
    stepped(&state, 3, FBT_TOL(2e-4, 2e-3) * second);
  }
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, out, &state, &input), FB_OK);
  FBT_INT_EQ(fb_system_energy(&mechanism, model, &work, &energy, &state, &input), FB_OK);
  FBT_INT_EQ(fb_system_momentum(&mechanism, model, &work, &momentum, &state, &input), FB_OK);
  whole[0] = (double)out->power * second / joule;
  whole[1] = (double)energy.kinetic / joule;
  whole[2] = (double)energy.strain / joule;
  whole[3] = (double)fbt_largest(momentum.angular, 3) / (joule * second);
  whole[4] = 1e3 * (double)fb_system_rk4_limit(&mechanism, model, 0, 0) / second;
  motion_in_si(out);
}

/* E9.1 to E9.19: a tree of all joints by each method, and pairs of bodies that a loop holds together, measured in other
   units of mass, length and time: the same motion, power, energy, momentum and longest step. */
TEST(systems_know_no_units)
{
  static const int exponent[3][3] = {{0, 0, 0}, {26, 6, 8}, {-26, -6, -8}}; /* of two */
  static fb_system_motion apart, first;
  for (int run = 0; run < 9; run++) {
    const int method = run < 3 ? run : (int)FB_METHOD_RECURSIVE, kind = run < 3 ? 0 : (int)FB_JOINT_RIGID + run - 3;
    double si[5], whole[5];
    if (run >= 3) {
      couple((fb_joint_kind)kind, 0, FB_AXIS_FREE);
      init(FB_METHOD_RECURSIVE);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &apart, &state, NULL), FB_OK);
    }
    for (int u = 0; u < 3; u++) {
      kilogram = ldexp(1.0, exponent[u][0] / (FB_SINGLE ? 2 : 1));
      meter = ldexp(1.0, exponent[u][1] / (FB_SINGLE ? 2 : 1));
      second = ldexp(1.0, exponent[u][2] / (FB_SINGLE ? 2 : 1));
      motion_in_units(u ? &motion : &first, u ? whole : si, method, kind, run < 3 ? NULL : &apart);
      FBT_BELOW(u ? motion_difference(&motion, &first) : 0.0, FBT_TOL(1e-9, 1e-3));
      for (int i = 0; i < 5 && u; i++) {
        FBT_NEAR_REL(whole[i], si[i], FBT_TOL(1e-9, 1e-3));
      }
    }
    kilogram = meter = second = 1.0;
  }
}

static void couple_steps(int n, double dt)
{
  for (int step = 0; step < n; step++) {
    const fb_system_input middle = driven(0.5 * dt), end = driven(dt);
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &middle, &end, (fb_real)dt), FB_OK);
    input = end;
  }
}

/* E9.7 to E9.15, E9.19: every kind of joint, free or with an axis locked or prescribed, moves two bodies in the same
   way from joint coordinates, by the dense matrix, as constraints of free bodies and as a loop, forwards and backwards:
   at the start, after a while, and after an axis is locked in motion. */
TEST(every_joint_is_the_same_eliminated_kept_or_closing_a_loop)
{
  static fb_system_motion first[3];
  for (int kind = (int)FB_JOINT_RIGID; kind <= (int)FB_JOINT_SPHERICAL; kind++) {
    const int axes = kind == FB_JOINT_CYLINDRICAL || kind == FB_JOINT_UNIVERSAL ? 2 : kind == FB_JOINT_RIGID ? 0 : 1;
    const int forms = kind == FB_JOINT_UNIVERSAL || kind == FB_JOINT_SPHERICAL ? 4 : 5; /* their axes have an order */
    for (int given = 0; given <= 2 * axes; given++) {                                   /* each locked, prescribed */
      const fb_axis_mode mode = given == 0 ? FB_AXIS_FREE : given % 2 ? FB_AXIS_LOCKED : FB_AXIS_PRESCRIBED;
      fb_real whole[3][3], other[3];
      for (int form = 0; form < forms; form++) {
        const int joint = form < 3 ? 1 : 2;
        couple((fb_joint_kind)kind, given > 0 ? (given - 1) / 2 : 0, mode);
        if (form >= 3) {
          couple_by_a_loop(&first[0], form == 4);
        }
        init(form < 3 ? (fb_method)form : FB_METHOD_RECURSIVE);
        FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
        for (int instant = 0; instant < 3; instant++) {
          fb_system_motion *tree_motion = &first[instant];
          couple_steps(instant > 0 ? 10 : 0, FBT_TOL(2e-4, 1e-3));
          if (instant == 2 && axes > 0) {
            memset(&work, 0xff, sizeof work);
            FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &work, &state, joint, axes - 1, FB_AXIS_LOCKED, &input),
                       FB_OK);
            couple_steps(5, FBT_TOL(2e-4, 1e-3));
          }
          if (form == 0) {
            couple_eval(tree_motion, whole[instant], joint, 0);
            continue;
          }
          couple_eval(&motion, other, joint, form == 4);
          if (form == 4) { /* they are about the other frame */
            memcpy(motion.joint[1].force, tree_motion->joint[1].force, sizeof motion.joint[1].force);
            memcpy(motion.joint[1].torque, tree_motion->joint[1].torque, sizeof motion.joint[1].torque);
          }
          FBT_BELOW(motion_difference(&motion, tree_motion), instant ? FBT_TOL(1e-9, 1e-2) : FBT_TOL(1e-11, 1e-3));
          FBT_BELOW(fbt_difference(motion.joint[1].value, tree_motion->joint[1].value, 3), FBT_TOL(1e-10, 1e-3));
          FBT_BELOW(fbt_difference(other, whole[instant], 3), instant ? FBT_TOL(1e-9, 1e-2) : FBT_TOL(1e-11, 1e-3));
        }
      }
    }
  }
}

/* E9.8: a screw without pitch is a hinge, eliminated or kept. */
TEST(screws_without_pitch_are_hinges)
{
  static fb_system_motion first;
  for (int run = 0; run < 6; run++) {
    couple(run % 2 ? FB_JOINT_SCREW : FB_JOINT_REVOLUTE, 0, FB_AXIS_FREE);
    desc.joint[1].pitch = FB_R(0.0);
    init((fb_method)(run / 2));
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    couple_steps(5, FBT_TOL(2e-4, 1e-3));
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, run ? &motion : &first, &state, &input), FB_OK);
    FBT_BELOW(run ? motion_difference(&motion, &first) : 0.0, FBT_TOL(1e-9, 1e-2));
  }
}

/* E9.14: momenta of axes that are locked or prescribed follow from the motion and have no rates of their own; those of
   the free ones beside them do. */
TEST(given_axes_have_no_momentum_rates)
{
  for (int run = 0; run < 8; run++) {
    const int kind = run % 4 < 2 ? FB_JOINT_CYLINDRICAL : run % 4 == 2 ? FB_JOINT_UNIVERSAL : FB_JOINT_SPHERICAL;
    const int axis = run % 4 == 1, ball = kind == FB_JOINT_SPHERICAL;
    couple((fb_joint_kind)kind, axis, run < 4 ? FB_AXIS_LOCKED : FB_AXIS_PRESCRIBED);
    desc.joint[0].mode[0] = ball ? FB_AXIS_PRESCRIBED : FB_AXIS_FREE;
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_rates(&mechanism, model, &work, &rate, &state, &input), FB_OK);
    for (int i = 0; i < 6; i++) {
      FBT_INT_EQ(fabs((double)rate.link[0].p[i]) > 0.0, !ball);
    }
    for (int i = 0; i < mechanism.joint[1].n_axis; i++) {
      FBT_INT_EQ(fabs((double)rate.link[1].p[i]) > 0.0, !ball && i != axis);
    }
  }
}

/* E9.16: a free body that is locked stands where it is, what hangs on it swings on; from the start or in motion. */
TEST(locked_free_bodies_stand)
{
  for (int run = 0; run < 6; run++) {
    fb_link_state before;
    couple(FB_JOINT_REVOLUTE, 0, FB_AXIS_FREE);
    desc.joint[0].mode[0] = run % 2 ? FB_AXIS_LOCKED : FB_AXIS_FREE;
    init((fb_method)(run / 2));
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &work, &state, 0, 0, FB_AXIS_LOCKED, &input), FB_OK);
    before = state.link[0];
    couple_steps(5, FBT_TOL(2e-4, 1e-3));
    FBT_BELOW(fbt_difference(state.link[0].x, before.x, 3), FBT_TOL(1e-14, 1e-6));
    FBT_BELOW(fbt_difference(state.link[0].quat, before.quat, 4), FBT_TOL(1e-14, 1e-6));
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    FBT_NEAR_ABS(fbt_largest(motion.motion[0].v, 3), 0.0, 0.0);
    FBT_NEAR_ABS(fbt_largest(motion.motion[0].w, 3), 0.0, 0.0);
    FBT_TRUE(fabs((double)motion.joint[1].speed[0]) > 0.01);
  }
}

/* Whatever is in the work before a call, it does the same, to the last bit; by each method and with a loop. */
TEST(work_means_nothing_between_calls)
{
  static fb_system_state begin[2], slope[2], after[2];
  static fb_system_motion at[2];
  for (int form = 0; form < 4; form++) {
    fb_energy energy[2];
    fb_momentum momentum[2];
    couple(FB_JOINT_REVOLUTE, 0, FB_AXIS_FREE);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    if (form == 3) {
      couple_by_a_loop(&motion, 0);
    }
    init(form < 3 ? (fb_method)form : FB_METHOD_RECURSIVE);
    for (int k = 0; k < 2; k++) {
      const int byte = k ? 0xff : 0;
      memset(&work, byte, sizeof work);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &begin[k], start, &input), FB_OK);
      memset(&work, byte, sizeof work);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &at[k], &begin[k], &input), FB_OK);
      memset(&work, byte, sizeof work);
      FBT_INT_EQ(fb_system_rates(&mechanism, model, &work, &slope[k], &begin[k], &input), FB_OK);
      memset(&work, byte, sizeof work);
      FBT_INT_EQ(fb_system_energy(&mechanism, model, &work, &energy[k], &begin[k], &input), FB_OK);
      memset(&work, byte, sizeof work);
      FBT_INT_EQ(fb_system_momentum(&mechanism, model, &work, &momentum[k], &begin[k], &input), FB_OK);
      after[k] = begin[k];
      memset(&work, byte, sizeof work);
      FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &work, &after[k], form < 3 ? 1 : 2, 0, FB_AXIS_LOCKED, &input),
                 FB_OK);
      memset(&work, byte, sizeof work);
      init(form < 3 ? (fb_method)form : FB_METHOD_RECURSIVE);
    }
    FBT_TRUE(memcmp(&begin[0], &begin[1], sizeof begin[0]) == 0);
    FBT_TRUE(memcmp(&at[0], &at[1], sizeof at[0]) == 0);
    FBT_TRUE(memcmp(&slope[0], &slope[1], sizeof slope[0]) == 0);
    FBT_TRUE(memcmp(&after[0], &after[1], sizeof after[0]) == 0);
    FBT_TRUE(memcmp(&energy[0], &energy[1], sizeof energy[0]) == 0);
    FBT_TRUE(memcmp(&momentum[0], &momentum[1], sizeof momentum[0]) == 0);
  }
}

/* E9.17: a loop whose axis is prescribed closes where it is told to be, from a start aside, whichever way it runs. */
TEST(a_prescribed_loop_closes_where_it_is_told)
{
  for (int kind = (int)FB_JOINT_REVOLUTE; kind < (int)FB_JOINT_SPHERICAL; kind++) {
    const int axis = kind == FB_JOINT_CYLINDRICAL || kind == FB_JOINT_UNIVERSAL;
    for (int form = 0; form < (kind == FB_JOINT_UNIVERSAL ? 1 : 2); form++) {
      couple((fb_joint_kind)kind, axis, FB_AXIS_PRESCRIBED);
      init(FB_METHOD_RECURSIVE);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
      couple_by_a_loop(&motion, form);
      input.drive[2].value[axis] += FB_R(0.05);
      init(FB_METHOD_RECURSIVE);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
      FBT_NEAR_ABS(motion.joint[2].value[axis], input.drive[2].value[axis], FBT_TOL(1e-12, 1e-4));
      FBT_NEAR_ABS(motion.joint[2].speed[axis], input.drive[2].rate[axis], FBT_TOL(1e-12, 1e-4));
    }
  }
}

/* E9.17: a loop with a locked axis closes from a rough guess where the free one does, and stays as it is then. */
TEST(a_locked_loop_closes_where_the_free_one_does)
{
  static fb_system_motion first;
  for (int locked = 0; locked < 2; locked++) {
    fourbar(0.3, 0.8, 0.6, 0.9, FB_JOINT_REVOLUTE);
    desc.loop[0].mode[0] = locked ? FB_AXIS_LOCKED : FB_AXIS_FREE;
    start[0].value[0] = FB_R(0.9);
    start[1].value[0] = FB_R(-0.6);
    start[2].value[0] = FB_R(1.5);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, locked ? &motion : &first, &state, NULL), FB_OK);
  }
  for (int k = 0; k < 3; k++) {
    FBT_BELOW(fbt_difference(motion.pose[k].rho, first.pose[k].rho, 3), FBT_TOL(1e-9, 1e-4));
    FBT_BELOW(fbt_difference(motion.pose[k].quat, first.pose[k].quat, 4), FBT_TOL(1e-9, 1e-4));
  }
  FBT_BELOW(0.1, fabs((double)first.joint[3].value[0]));
  couple_steps(5, 0.01);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
  FBT_NEAR_ABS(motion.joint[3].value[0], first.joint[3].value[0], FBT_TOL(1e-9, 1e-4));
}

/* No input is one of zeros, to the last bit: motors are off, prescribed axes and bodies stand at zero; in joint
   coordinates, by the dense matrix, as constraints and as a loop. */
TEST(no_input_is_an_input_of_zeros)
{
  static fb_system_motion at[2];
  static fb_system_state begin[2], end[2], slope[2];
  static const fb_joint_kind kinds[] = {FB_JOINT_CYLINDRICAL, FB_JOINT_UNIVERSAL, FB_JOINT_SPHERICAL};
  for (int run = 0; run < 24; run++) {
    const fb_axis_mode mode = run / 3 % 2 ? FB_AXIS_PRESCRIBED : FB_AXIS_FREE;
    const int form = run / 6;
    couple(kinds[run % 3], 0, mode);
    desc.joint[0].mode[0] = mode;
    memset(&input, 0, sizeof input);
    if (form == 3) {
      init(FB_METHOD_RECURSIVE);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
      couple_by_a_loop(&motion, 0);
    }
    init(form < 3 ? (fb_method)form : FB_METHOD_RECURSIVE);
    for (int zeros = 0; zeros < 2; zeros++) {
      const fb_system_input *in = zeros ? &input : NULL;
      fb_system_state *s = &end[zeros];
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &begin[zeros], start, in), FB_OK);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &at[zeros], &begin[zeros], in), FB_OK);
      FBT_INT_EQ(fb_system_rates(&mechanism, model, &work, &slope[zeros], &begin[zeros], in), FB_OK);
      *s = begin[zeros];
      memset(&work, 0xff, sizeof work); /* and what is in it means nothing */
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, s, &work, in, in, in, FB_R(2e-4)), FB_OK);
      FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, s, &work, in, in, FB_R(2e-4), 2), FB_OK);
      FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &work, s, form < 3 ? 1 : 2, 0, FB_AXIS_LOCKED, in), FB_OK);
    }
    FBT_TRUE(memcmp(&begin[0], &begin[1], sizeof begin[0]) == 0);
    FBT_TRUE(memcmp(&at[0], &at[1], sizeof at[0]) == 0);
    FBT_TRUE(memcmp(&slope[0], &slope[1], sizeof slope[0]) == 0);
    FBT_TRUE(memcmp(&end[0], &end[1], sizeof end[0]) == 0);
    if (mode == FB_AXIS_PRESCRIBED && kinds[run % 3] != FB_JOINT_SPHERICAL) {
      FBT_NEAR_ABS(at[0].joint[form < 3 ? 1 : 2].value[0], 0.0, FBT_TOL(1e-12, 1e-4));
      FBT_NEAR_ABS(at[0].joint[form < 3 ? 1 : 2].speed[0], 0.0, FBT_TOL(1e-12, 1e-4));
    }
    FBT_NEAR_ABS(slope[0].motor_work, 0.0, 0.0);
  }
}

/* One field changed by as little as makes it wrong. */
static void refused_with(void *field, int value)
{
  int was;
  memcpy(&was, field, sizeof was);
  memcpy(field, &value, sizeof value);
  FBT_TRUE(fb_system_check(&mechanism, model, 1) != FB_OK);
  memcpy(field, &was, sizeof was);
}

static void refused_without(fb_real *field, int n)
{
  for (int i = 0; i < n; i++) {
    const fb_real was = field[i];
    field[i] = (fb_real)NAN;
    FBT_TRUE(fb_system_check(&mechanism, model, 1) != FB_OK);
    field[i] = was;
  }
}

/* fb_system_check: every field beyond its range, of the system, of a joint of the tree and of one that closes a loop,
   is found; at the ends of the range all is well. */
TEST(systems_that_memory_has_changed_are_refused)
{
  fb_joint *joint = mechanism.joint;
  couple(FB_JOINT_SPHERICAL, 0, FB_AXIS_FREE);
  close_loop(FB_JOINT_REVOLUTE, 1, 2, 0, 2);
  close_loop(FB_JOINT_REVOLUTE, FB_GROUND, 0, 1, 0);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_check(&mechanism, model, 1), FB_OK);
  FBT_INT_EQ(fb_system_check(&mechanism, model, 0), FB_ERR_CAPACITY);
  refused_with(&mechanism.n_body, 0);
  refused_with(&mechanism.n_body, FB_MAX_BODIES + 1);
  refused_with(&mechanism.n_loop, -1);
  refused_with(&mechanism.n_loop, FB_MAX_LOOPS + 1);
  refused_with(&mechanism.method, FB_METHOD_MULTIPLIERS + 1);
  refused_with(&mechanism.allow_long_step, 2);
  refused_with(&mechanism.model[1], 1);
  refused_with(&mechanism.model[1], -1);
  refused_with(&mechanism.coupled[0], 2);
  refused_with(&mechanism.free.kind, FB_JOINT_RIGID);
  refused_with(&mechanism.free.n_axis, 5);
  refused_with(&mechanism.free.parent, 0);
  refused_without(&mechanism.limit_elastic, 1);
  refused_without(&mechanism.limit_damping, 1);
  refused_without(&mechanism.limit_kept_elastic, 1);
  refused_without(&mechanism.limit_kept_damping, 1);
  refused_with(&joint[0].parent, 0);      /* a body hangs on an earlier one */
  refused_with(&joint[0].parent_node, 1); /* the ground has one node */
  refused_with(&joint[1].parent, 1);
  refused_with(&joint[1].child, 0);
  for (int j = 1; j < 3; j++) {
    refused_with(&joint[j].kind, FB_JOINT_SPHERICAL + 1);
    refused_with(&joint[j].parent, FB_GROUND - 1);
    refused_with(&joint[j].parent, 2);
    refused_with(&joint[j].child, 2);
    refused_with(&joint[j].child, -1);
    refused_with(&joint[j].parent_node, -1);
    refused_with(&joint[j].parent_node, 3);
    refused_with(&joint[j].child_node, -1);
    refused_with(&joint[j].child_node, 3);
    refused_with(&joint[j].n_axis, joint[j].n_axis - 1);
    refused_with(&joint[j].n_axis, joint[j].n_axis + 1);
    refused_with(&joint[j].moves, 2);
    refused_with(&joint[j].turned, 2);
    refused_without(joint[j].position, 3);
    refused_without(joint[j].axes, 9);
    refused_without(joint[j].child_position, 3);
    refused_without(joint[j].child_axes, 9);
    refused_without(joint[j].A, 18);
    refused_without(&joint[j].pitch, 1);
    refused_without(joint[j].stiffness, 3);
    refused_without(joint[j].rest, 3);
    refused_without(joint[j].damping, 3);
    for (int i = 0; i < 3; i++) {
      const fb_real stiffness = joint[j].stiffness[i], damping = joint[j].damping[i];
      refused_with(&joint[j].mode[i], FB_AXIS_PRESCRIBED + 1);
      joint[j].stiffness[i] = -FB_R(1.0);
      FBT_TRUE(fb_system_check(&mechanism, model, 1) != FB_OK);
      joint[j].stiffness[i] = stiffness;
      joint[j].damping[i] = -FB_R(1.0);
      FBT_TRUE(fb_system_check(&mechanism, model, 1) != FB_OK);
      joint[j].damping[i] = damping;
    }
  }
}

/* fb_system_state_check, and what fb_system_state_init takes: attitudes where there are any, modes, where locked axes
   are; as far as a body may be deflected and no further. */
TEST(states_out_of_range_are_refused)
{
  const int beyond = FB_AXIS_PRESCRIBED + 1;
  for (int j = 0; j < 3; j++) { /* free, spherical, revolute */
    couple(FB_JOINT_SPHERICAL, 0, FB_AXIS_FREE);
    hang(2, 0, FB_JOINT_REVOLUTE, 1, 1);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_state_check(&mechanism, model, &state), FB_OK);
    kept = state;
    memset(kept.link[j].quat, 0, sizeof kept.link[j].quat);
    FBT_INT_EQ(fb_system_state_check(&mechanism, model, &kept) == FB_OK, j == 2);
    for (int i = 0; i < 3; i++) {
      kept = state;
      kept.mode[j][i] = FB_AXIS_PRESCRIBED;
      FBT_INT_EQ(fb_system_state_check(&mechanism, model, &kept), FB_OK);
      memcpy(&kept.mode[j][i], &beyond, sizeof beyond);
      FBT_INT_EQ(fb_system_state_check(&mechanism, model, &kept), FB_ERR_VALUE);
      kept = state;
      kept.hold[j][i] = (fb_real)NAN;
      FBT_INT_EQ(fb_system_state_check(&mechanism, model, &kept), FB_ERR_NOT_FINITE);
      kept = state;
      kept.link[j].x[i] = (fb_real)NAN;
      FBT_INT_EQ(fb_system_state_check(&mechanism, model, &kept), FB_ERR_NOT_FINITE);
    }
    for (int over = 0; over < 2; over++) { /* the parts of two modes add up, whatever their signs */
      const double limit = (double)model[0].deflection_limit;
      start[j].q[0] = (fb_real)(0.6 * limit / (double)model[0].reach[0]);
      start[j].q[1] = -(fb_real)((over ? 0.42 : 0.38) * limit / (double)model[0].reach[1]);
      start[j].q[2] = FB_R(0.0);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &kept, start, NULL), over ? FB_ERR_RANGE : FB_OK);
    }
  }
}

/* E9.15: how far a body may be deflected holds for each of its modes alone, of every body. */
TEST(every_mode_is_within_its_range)
{
  fresh();
  flexible(&model[0], 2, 2, 0, FB_EFFECTS_FULL);
  hang(0, 0, FB_JOINT_RIGID, FB_GROUND, 0);
  hang(1, 0, FB_JOINT_RIGID, FB_GROUND, 0);
  init(FB_METHOD_RECURSIVE);
  for (int run = 0; run < 16; run++) {
    const int k = run / 8, a = run / 2 % 4, over = run % 2;
    memset(start, 0, sizeof start);
    start[k].q[a] = (fb_real)(over ? 1.01 : 0.99) * model[0].deflection_limit / model[0].reach[a];
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), over ? FB_ERR_RANGE : FB_OK);
  }
}

/* E9.17: from a rough guess joints move and modes do not, however soft, and what the bodies carry stays: linear and
   angular momentum of two free bodies are those before the loop took hold. */
TEST(a_loop_that_closes_keeps_shape_and_momentum)
{
  for (int run = 0; run < 14; run++) {
    const int kind = (int)FB_JOINT_RIGID + run / 2, soft = run % 2;
    fb_momentum before, after;
    couple((fb_joint_kind)kind, 0, FB_AXIS_FREE);
    for (int a = 0; a < model[0].n && soft; a++) {
      model[0].K.diagonal[a] *= FB_R(1e-10);
    }
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    couple_by_a_loop(&motion, 0);
    start[1].value[0] += FB_R(0.05);
    start[1].value[1] -= FB_R(0.04);
    desc.n_loop = 0;
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_momentum(&mechanism, model, &work, &before, &state, NULL), FB_OK);
    desc.n_loop = 1;
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_momentum(&mechanism, model, &work, &after, &state, NULL), FB_OK);
    FBT_BELOW(fbt_difference(after.linear, before.linear, 3), FBT_TOL(1e-12, 1e-5));
    FBT_BELOW(fbt_difference(after.angular, before.angular, 3), FBT_TOL(1e-12, 1e-4));
    for (int k = 0; k < 2; k++) {
      FBT_BELOW(fbt_difference(state.link[k].q, start[k].q, model[0].n), 1e-6);
    }
  }
}

/* E9.8: slides know no turns: a loop brings a body five meters along, and locked it stays there. */
TEST(loops_slide_any_way)
{
  for (int run = 0; run < 2; run++) {
    const int axis = run; /* of a prismatic and of a cylindrical joint */
    fresh();
    rigid(&model[0], 1.0, 0, 0, 0, 1.0, 1.0, 1.0);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    close_loop(run ? FB_JOINT_CYLINDRICAL : FB_JOINT_PRISMATIC, FB_GROUND, 0, 0, 0)->mode[axis] = FB_AXIS_PRESCRIBED;
    input.drive[1].value[axis] = FB_R(5.0);
    start[0].value[2] = FB_R(1.0);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    FBT_NEAR_ABS(state.link[0].x[2], 5.0, FBT_TOL(1e-12, 1e-5));
    FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &work, &state, 1, axis, FB_AXIS_LOCKED, &input), FB_OK);
    state.link[0].p[2] = FB_R(0.0);
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, FB_R(0.01)), FB_OK);
    FBT_NEAR_ABS(state.link[0].x[2], 5.0, FBT_TOL(1e-12, 1e-5));
  }
}

/* E9.17: a ball joint that closes a loop, locked as a whole, closes as a free one does and holds what it comes to. */
TEST(a_locked_ball_holds_where_it_closes)
{
  fb_real quat[4];
  fb_system_state closed;
  for (int locked = 0; locked < 2; locked++) {
    fresh();
    rigid(&model[0], 1.0, 0.2, 0.1, 0, 1.0, 1.5, 2.0);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    close_loop(FB_JOINT_SPHERICAL, FB_GROUND, 0, 0, 0)->mode[0] = locked ? FB_AXIS_LOCKED : FB_AXIS_FREE;
    desc.loop[0].child_position[0] = FB_R(0.4);
    turn(start[0].quat, 0.7, -0.4, 0.5);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    if (!locked) {
      closed = state;
    }
  }
  FBT_BELOW(fbt_difference(state.link[0].quat, closed.link[0].quat, 4), FBT_TOL(1e-12, 1e-5));
  FBT_BELOW(fbt_difference(state.link[0].x, closed.link[0].x, 3), FBT_TOL(1e-12, 1e-5));
  memcpy(quat, state.link[0].quat, sizeof quat);
  input.n_load = 1;
  input.load[0].load.torque[0] = input.load[0].load.torque[1] = input.load[0].load.torque[2] = FB_R(1.0);
  for (int step = 0; step < 10; step++) {
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(0.01)), FB_OK);
  }
  FBT_BELOW(fbt_difference(state.link[0].quat, quat, 4), FBT_TOL(1e-12, 1e-5));
}

/* E9.17: a loop that holds a point of a ball beside where it is turns the ball the shortest way there: not about that
   point. */
TEST(a_loop_closes_the_shortest_way)
{
  for (int run = 0; run < 6; run++) {
    const fb_joint_kind kind = run % 2 ? FB_JOINT_SPHERICAL : FB_JOINT_FREE;
    fb_real before[9], after[9], way[9], quat[4], turned[3], point[3] = {FB_R(0.6), FB_R(0.3), -FB_R(0.2)}, held[3];
    fb_joint_desc *loop;
    fresh();
    rigid(&model[0], 1.0, 0, 0, 0, 2.0, 2.0, 2.0);
    hang(0, 0, kind, FB_GROUND, 0);
    fbt_seed((unsigned)(run + 1));
    turn_anyhow(start[0].quat, 1.5);
    fb_quat_to_mat33(before, start[0].quat);
    fb_mat33_mul_vec3(held, before, point);
    loop = close_loop(FB_JOINT_SPHERICAL, FB_GROUND, 0, 0, 0);
    memcpy(loop->child_position, point, sizeof point);
    turn_anyhow(quat, 0.05);
    fb_quat_to_mat33(way, quat);
    fb_mat33_mul_vec3(loop->position, way, held);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    fb_quat_to_mat33(after, state.link[0].quat);
    for (int i = 0; i < 9; i++) { /* after before^T */
      way[i] = fb_vec3_dot(after + i / 3 * 3, before + i % 3 * 3);
    }
    turned[0] = way[7] - way[5]; /* twice the axis times the sine */
    turned[1] = way[2] - way[6];
    turned[2] = way[3] - way[1];
    FBT_TRUE(fbt_largest(turned, 3) > 0.002);
    FBT_BELOW(fabs((double)fb_vec3_dot(turned, held)), 0.01 * fbt_largest(turned, 3));
  }
}

/* E9.17: right angles are there half a turn off, too: a loop closed that way is refused, by kind and axis. */
TEST(loops_are_closed_the_right_way_round)
{
  for (int kind = (int)FB_JOINT_RIGID; kind <= (int)FB_JOINT_SPHERICAL; kind++) {
    const int ball = kind == FB_JOINT_SPHERICAL;
    const int slides = kind == FB_JOINT_PRISMATIC || kind == FB_JOINT_RIGID;
    for (int axis = 0; axis < 3; axis++) {
      const int turns = ball || (kind == FB_JOINT_UNIVERSAL && axis != 1) || (axis == 2 && !slides);
      fresh();
      rigid(&model[0], 1.0, 0.2, 0, 0, 0.1, 0.1, 0.1);
      hang(0, 0, FB_JOINT_SPHERICAL, FB_GROUND, 0);
      close_loop((fb_joint_kind)kind, FB_GROUND, 0, 0, 0);
      turn(start[0].quat, axis == 0 ? 3.0 : 0.0, axis == 1 ? 3.0 : 0.0, axis == 2 ? 3.0 : 0.0);
      init(FB_METHOD_RECURSIVE);
      if (kind != FB_JOINT_UNIVERSAL || axis != 1) {
        FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL),
                   turns ? FB_OK : FB_ERR_CONTRADICTION);
      }
    }
  }
}

/* got is after to a thirtieth of the way from before, but for rounding. */
static void nearly(const fb_real *got, const fb_real *after, const fb_real *before, int n)
{
  const double rounding = FBT_TOL(1e-13, 1e-6) * fbt_largest(after, n) + 1e-30;
  FBT_BELOW(fbt_difference(got, after, n), 0.03 * fbt_difference(after, before, n) + rounding);
}

/* E9.4, E9.6, E11.13: the matrix of an implicit step is that of the linear system, with springs and dampers of joints
   and of modes, and locked axes: about the undeformed shape one iteration of a step of many periods is as good as twenty. */
TEST(one_iteration_is_enough_for_a_linear_system)
{
  static fb_system_state end[2];
  for (int run = 0; run < 8; run++) {
    double size = 0.0, miss = 0.0;
    couple(run % 2 ? FB_JOINT_CYLINDRICAL : FB_JOINT_SPHERICAL, 0, run < 4 ? FB_AXIS_FREE : FB_AXIS_LOCKED);
    memset(&input, 0, sizeof input);
    for (int a = 0; a < FB_MAX_MODES; a++) {
      body_desc.zeta[a] = FB_R(0.4);
    }
    flexible(&model[0], 1, 1, 1, FB_EFFECTS_FULL | FB_EFFECT_DAMPING);
    memset(desc.joint[1].rest, 0, sizeof desc.joint[1].rest);
    memset(start[1].quat, 0, sizeof start[1].quat);
    for (int i = 0; i < 3; i++) {
      desc.joint[1].stiffness[i] = (fb_real)(1e4 / (1 + 9 * i)); /* a spherical joint has the first alone */
      desc.joint[1].damping[i] = (fb_real)(1e2 / (1 + 9 * i));
    }
    for (int k = 0; k < 2; k++) {
      memset(start[k].speed, 0, sizeof start[k].speed);
      memset(start[k].q_dot, 0, sizeof start[k].q_dot);
      for (int i = 0; i < 3; i++) {
        start[k].value[i] *= FB_R(1e-4);
        start[k].speed[3 * (1 - k) + i] = (fb_real)(1e-3 * (i + 1));
      }
      for (int a = 0; a < model[0].n; a++) {
        start[k].q[a] *= FB_R(1e-2);
      }
    }
    desc.allow_long_step = 1;
    init((fb_method)(run / 2 % 2));
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    for (int k = 0; k < 2; k++) {
      end[k] = state;
      FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &end[k], &work, NULL, NULL, FB_R(0.5), k ? 20 : 1), FB_OK);
    }
    for (int k = 0; k < 2; k++) {
      size = fmax(size, fbt_largest(end[1].link[k].pi, model[0].n));
      miss = fmax(miss, fbt_difference(end[0].link[k].pi, end[1].link[k].pi, model[0].n));
      nearly(end[0].link[k].x, end[1].link[k].x, state.link[k].x, 3);
      nearly(end[0].link[k].quat, end[1].link[k].quat, state.link[k].quat, 4);
      nearly(end[0].link[k].p, end[1].link[k].p, state.link[k].p, 3);
      nearly(end[0].link[k].p + 3, end[1].link[k].p + 3, state.link[k].p + 3, 3);
      nearly(end[0].link[k].q, end[1].link[k].q, state.link[k].q, model[0].n);
    }
    FBT_BELOW(miss, 2e-3 * size); /* of 6e-4, what is not linear */
  }
}

/* A flexible beam of p11's kind: length, mass per length, EI in the plane; z is out of the plane. */
static void link_beam(fb_body *body, double length, double mass, double EI, double EA, int bending, int axial,
                      double deflection)
{
  static fb_modes_desc keep;
  int node;
  fb_body_desc d = body_desc;
  memset(&keep, 0, sizeof keep);
  memset(&beam_desc, 0, sizeof beam_desc);
  beam_desc.root = FB_ROOT_PINNED; /* the slope at the hinge is free: well conditioned, the frame is the mean axis */
  beam_desc.length = (fb_real)length;
  beam_desc.n_element = 8;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = (fb_real)mass;
  beam_desc.station[0].EI_z = (fb_real)EI;
  beam_desc.station[0].EA = (fb_real)EA;
  keep.count[FB_KIND_BEND_Y] = bending;
  keep.count[FB_KIND_AXIAL] = axial;
  d.base = FB_BASE_PRESCRIBED;
  d.effects |= FB_EFFECTS_FULL;
  d.deflection_limit = (fb_real)deflection;
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, (fb_real)length), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, (fb_real)(0.5 * length)), FB_OK);
  FBT_INT_EQ(fb_body_init(body, &body_work, &shape, &d), FB_OK);
}

/* Position of a node of a body, from the motion of the system. */
static void node_at(double x[3], const fb_system_state *s, int body, int node)
{
  fb_node_motion at;
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, s, &input), FB_OK);
  FBT_INT_EQ(fb_body_node_motion(&model[desc.model[body]], &at, &motion.pose[body], &motion.motion[body], node), FB_OK);
  for (int i = 0; i < 3; i++) {
    x[i] = (double)at.position[i];
  }
}

typedef struct crowd {
  int rows, ends, beyond; /* rows (0: as many as there is room for), nodes that they hold, how many more to claim */
} crowd;

/* Ties nodes of the last bodies, of high numbers, to each other, each time in another way, in directions that turn with
   a body. */
static int crowd_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  crowd *const tied = (crowd *)user;
  (void)t;
  tied->rows = tied->rows ? tied->rows : capacity;
  for (int k = 0; k < tied->rows && k < capacity; k++) {
    for (int s = 0; s < 2; s++) {
      const int end = (k * (s + 1) + s) % tied->ends;
      fb_real force[3], torque[3];
      row[k].body[s] = FB_MAX_BODIES - 1 - end % FB_MAX_BODIES;
      row[k].node[s] = FB_MAX_NODES - 1 - end / FB_MAX_BODIES;
      for (int i = 0; i < 3; i++) {
        force[i] = (fb_real)sin(1.0 + 7.0 * k * k + 5.0 * s + i);
        torque[i] = (fb_real)sin(2.0 + 3.0 * k * k + 4.0 * s + i);
      }
      fb_mat33_mul_vec3(row[k].force[s], pose[k % FB_MAX_BODIES].R, force);
      fb_mat33_mul_vec3(row[k].torque[s], pose[k % FB_MAX_BODIES].R, torque);
    }
  }
  return tied->rows + tied->beyond;
}

/* As many bodies as there can be, each with as many modes and nodes, by all kinds of joints; motors, springs, an axis
   that is locked; as many loads; as many loops, to the ground, nearly closed. */
static void full_house(void)
{
  fresh();
  fbt_seed(17);
  body_desc.effects = FB_EFFECT_GRAVITY;
  fbt_fill(body_desc.gravity, 3, 3.0);
  crowded(&model[0]);
  for (int k = 0; k < FB_MAX_BODIES; k++) {
    fb_joint_desc *j = &desc.joint[k];
    hang(k, 0, (fb_joint_kind)(k % 8), k < 2 ? k - 1 : k - 2, 1 + k % (FB_MAX_NODES - 5));
    fbt_fill(start[k].value, 3, 0.5);
    fbt_fill(start[k].speed, 6, 0.5);
    fbt_fill(start[k].q, FB_MAX_MODES, 0.05);
    fbt_fill(start[k].q_dot, FB_MAX_MODES, 0.2);
    fbt_fill(j->position, 3, 0.2);
    fbt_fill(j->child_position, 3, 0.2);
    j->pitch = FB_R(0.1);
    for (int i = 0; i < 3 && k % 8 > 0; i++) {
      j->stiffness[i] = (fb_real)(2.0 + fbt_random());
    }
    fbt_fill(input.drive[k].torque, 3, 0.5);
    input.load[k % FB_MAX_LOADS].body = k;
  }
  desc.joint[4].mode[1] = FB_AXIS_LOCKED;
  start[4].speed[1] = FB_R(0.0);
  input.n_load = FB_MAX_LOADS;
  for (int i = 0; i < FB_MAX_LOADS; i++) {
    input.load[i].load.node = FB_MAX_NODES - 1 - i % FB_MAX_NODES;
    input.load[i].load.axes = (fb_axes)(i % 3);
    fbt_fill(input.load[i].load.force, 3, 1.0);
    fbt_fill(input.load[i].load.torque, 3, 0.3);
  }
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
  for (int j = 0; j < FB_MAX_LOOPS; j++) {
    double x[3];
    fb_joint_desc *loop = close_loop(FB_JOINT_SPHERICAL, FB_GROUND, 0, FB_MAX_BODIES - 1 - j, FB_MAX_NODES - 4);
    node_at(x, &state, FB_MAX_BODIES - 1 - j, FB_MAX_NODES - 4);
    for (int i = 0; i < 3; i++) {
      loop->position[i] = (fb_real)x[i];
    }
  }
}

/* Power of motors, of what is prescribed, and of the loads. */
static double power_of(const fb_system_motion *at)
{
  double power = (double)at->power;
  for (int i = 0; i < input.n_load; i++) {
    const fb_load *load = &input.load[i].load;
    const int k = input.load[i].body;
    fb_real R[9], v[3], w[3];
    fb_node_motion node;
    FBT_INT_EQ(fb_body_node_motion(&model[desc.model[k]], &node, &at->pose[k], &at->motion[k], load->node), FB_OK);
    memcpy(v, node.velocity, sizeof v);
    memcpy(w, node.angular_rate, sizeof w);
    if (load->axes != FB_AXES_INERTIAL) {
      fb_quat_to_mat33(R, load->axes == FB_AXES_BODY ? at->pose[k].quat : node.quat);
      fb_mat33_mulT_vec3(v, R, node.velocity);
      fb_mat33_mulT_vec3(w, R, node.angular_rate);
    }
    power += (double)(fb_vec3_dot(load->force, v) + fb_vec3_dot(load->torque, w));
  }
  return power;
}

/* Rate of the energy along the rates of the state. */
static double energy_rate(void)
{
  static const double weight[5] = {1.0 / 12, -2.0 / 3, 0, 2.0 / 3, -1.0 / 12};
  const double h = FBT_TOL(1e-4, 1e-2);
  double slope = 0.0;
  FBT_INT_EQ(fb_system_rates(&mechanism, model, &work, &rate, &state, &input), FB_OK);
  for (int side = -2; side <= 2; side++) {
    moved(&kept, &state, &rate, side * h);
    slope += weight[side + 2] / h * energy_of(&kept);
  }
  return slope;
}

/* From the state on: a step by either scheme does the work of the mean power; both end alike; it may be looked at, an
   axis freed and locked again. */
static void full_step(double dt)
{
  static fb_system_motion first;
  static fb_system_state begin;
  const double before = energy_of(&state);
  const fb_real h = (fb_real)dt;
  begin = state;
  for (int scheme = 0; scheme < 2; scheme++) {
    double power;
    state = begin;
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    power = power_of(&motion);
    FBT_INT_EQ(scheme ? fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, h, 0)
                      : fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, h),
               FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, scheme ? &motion : &first, &state, &input), FB_OK);
    power = 0.5 * (power + power_of(scheme ? &motion : &first));
    FBT_NEAR_REL(energy_of(&state) - before, power * dt, FBT_TOL(1e-3, 1e-1));
  }
  FBT_BELOW(motion_difference(&motion, &first), FBT_TOL(1e-7, 1e-4));
  FBT_INT_EQ(fb_system_state_check(&mechanism, model, &state), FB_OK);
  FBT_TRUE(fb_system_crc(&mechanism, model, FB_MAX_BODIES) != 0);
  FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &work, &state, 4, 1, FB_AXIS_FREE, &input), FB_OK);
  FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &work, &state, 4, 1, FB_AXIS_LOCKED, &input), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &first, &state, &input), FB_OK);
  FBT_BELOW(motion_difference(&motion, &first), FBT_TOL(1e-10, 1e-2));
}

/* E9.3 to E9.19: there may be as many bodies, modes, nodes, loops, loads, constraints and nodes in them as the header
   says, and not one more: the energy changes by the power of motors and loads, kept joints move as eliminated ones. */
TEST(a_full_system_balances_its_energy)
{
  static fb_system_motion first;
  const int ends = 2 * (FB_MAX_BODIES + FB_MAX_LOOPS);
  crowd tied = {0, 0, 0};
  fb_momentum momentum[3];
  full_house();
  input.rows = crowd_rows;
  input.user = &tied;
  for (int run = 0; run < 3; run++) { /* few rows of the caller, by two methods; as many as there is room for */
    const int joints = run == 0 ? 2 * (FB_MAX_BODIES - 1) + 1 + FB_MAX_LOOPS : 1 + FB_MAX_LOOPS;
    fb_system_motion *at = run == 0 ? &first : &motion;
    tied.rows = run == 1 ? tied.rows : 0;
    tied.ends = run == 1 ? tied.ends : ends - joints;
    init(run == 0 ? FB_METHOD_MULTIPLIERS : FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    FBT_TRUE(run == 1 || (work.n_row == FB_MAX_ROWS && work.n_end == ends));
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, at, &state, &input), FB_OK);
    FBT_NEAR_ABS(energy_rate(), power_of(at), FBT_TOL(1e-9, 2e-2));
    FBT_INT_EQ(fb_system_momentum(&mechanism, model, &work, &momentum[run], &state, &input), FB_OK);
    FBT_BELOW(run == 1 ? motion_difference(at, &first) : 0.0, FBT_TOL(1e-10, 1e-3));
    FBT_BELOW(run == 1 ? fbt_difference(momentum[1].linear, momentum[0].linear, 3) : 0.0, FBT_TOL(1e-10, 1e-3));
    FBT_BELOW(run == 1 ? fbt_difference(momentum[1].angular, momentum[0].angular, 3) : 0.0, FBT_TOL(1e-10, 1e-3));
    full_step(FBT_TOL(1e-3, 4e-3)); /* single: longer, as its work is a few last digits of the energy */
    for (int more = 0; more < 2 && run != 1; more++) { /* a row, a node that rows hold */
      crowd over = tied;
      over.beyond = 1 - more;
      over.ends += more;
      input.user = &over;
      kept = state;
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(1e-3)),
                 FB_ERR_CAPACITY);
      FBT_TRUE(memcmp(&kept, &state, sizeof state) == 0);
      input.user = &tied;
    }
  }
}

/* E9.6: the dense matrix takes as many speeds as there is room for, and not one more. */
TEST(a_dense_matrix_may_be_full)
{
  static fb_system_motion first;
  int speeds = 6 + 2 + 2 * FB_MAX_MODES, n = 2;
  fresh();
  fbt_seed(19);
  crowded(&model[0]);
  rigid(&model[1], 0.7, 0.2, 0.1, -0.1, 0.3, 0.5, 0.4);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  hang(1, 0, FB_JOINT_UNIVERSAL, 0, 1);
  for (; speeds < FB_MAX_SPEEDS; n++) {
    const int left = FB_MAX_SPEEDS - speeds;
    hang(n, 1, left > 2 ? FB_JOINT_SPHERICAL : left > 1 ? FB_JOINT_UNIVERSAL : FB_JOINT_REVOLUTE, n % 2, 1 + n);
    speeds += left > 2 ? 3 : left;
  }
  for (int k = 0; k < n; k++) {
    fbt_fill(start[k].value, 3, 0.3);
    fbt_fill(start[k].speed, 6, 0.5);
    fbt_fill(start[k].q, FB_MAX_MODES, 0.05);
    fbt_fill(start[k].q_dot, FB_MAX_MODES, 0.2);
  }
  for (int method = 0; method < 2; method++) {
    init((fb_method)method);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, NULL, NULL, FB_R(1e-2), 0), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, method ? &motion : &first, &state, NULL), FB_OK);
  }
  FBT_BELOW(motion_difference(&motion, &first), FBT_TOL(1e-10, 1e-2));
  hang(n, 1, FB_JOINT_REVOLUTE, 0, 1);
  FBT_INT_EQ(fb_system_init(&mechanism, &work, model, 2, &desc), FB_ERR_CAPACITY);
}

/* E9.12, E9.15 on p11: a double pendulum of very flexible links falls from the horizontal. */
TEST(flexible_double_pendulum_follows_the_reference)
{
  const fbt_table *table = fbt_reference("p11_double_pendulum.csv");
  for (int bending = 2; bending <= 4; bending++) {
    double worst = 0.0, hinge = 0.0;
    fresh();
    body_desc.effects = FB_EFFECT_GRAVITY;
    body_desc.gravity[1] = -FB_R(9.81);
    link_beam(&model[0], 1.0, 0.5, 2.0, 2e4, bending, 0, 1.0);
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    hang(1, 0, FB_JOINT_REVOLUTE, 0, 1);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, NULL, NULL), FB_OK);
    for (int row = 1; row < table->rows && fbt_value(table, row, "t") < 1.51; row++) {
      const double T = fbt_value(table, row, "t") - fbt_value(table, row - 1, "t");
      const int n = (int)ceil(T / FBT_TOL(1e-4, 2e-4));
      double x[3];
      for (int k = 0; k < n; k++) {
        FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, (fb_real)(T / n)), FB_OK);
      }
      node_at(x, &state, 1, 1);
      worst = fmax(worst, hypot(x[0] - fbt_value(table, row, "tip_x"), x[1] - fbt_value(table, row, "tip_y")));
      node_at(x, &state, 0, 1);
      hinge = fmax(hinge, hypot(x[0] - fbt_value(table, row, "hinge_x"), x[1] - fbt_value(table, row, "hinge_y")));
    }
    FBT_BELOW(worst, 0.01);
    FBT_BELOW(hinge, 0.01);
    if (bending == 3) {
      fbt_figure("flexible double pendulum, tip to 1.5 s [link lengths]", "p11_double_pendulum.csv", worst);
    }
  }
}

/* E9.8, E9.10, E9.17 on p11: crank (massless, driven), flexible rod, slider. */
TEST(slider_crank_follows_the_reference)
{
  const fbt_table *table = fbt_reference("p11_slider_crank.csv");
  const double a = 0.15, L = 0.3, spin = 150.0;
  for (int bending = 1; bending <= 3; bending++) {
    double slider = 0.0, mid = 0.0;
    fb_system_input middle;
    fresh();
    rigid(&model[1], 0.0, 0.5 * a, 0, 0, 0, 0, 0);
    rigid(&model[2], 0.075552, 0, 0, 0, 0, 0, 0);
    link_beam(&model[0], L, 0.50368, 68.2666666667, 1.28e7, bending, 0, 0.1);
    hang(0, 1, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    hang(1, 0, FB_JOINT_REVOLUTE, 0, 1);
    hang(2, 2, FB_JOINT_PRISMATIC, FB_GROUND, 0);
    turn(desc.joint[2].attitude, 0, pi / 2, 0); /* z of the joint along x */
    turn(desc.joint[2].child_attitude, 0, pi / 2, 0);
    close_loop(FB_JOINT_REVOLUTE, 1, 1, 2, 0);
    desc.joint[0].mode[0] = FB_AXIS_PRESCRIBED;
    input.drive[0].rate[0] = (fb_real)spin;
    start[0].speed[0] = (fb_real)spin;
    start[1].speed[0] = (fb_real)(-spin - a * spin / L);
    start[2].value[0] = (fb_real)(a + L);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    middle = input;
    for (int row = 1; row < table->rows; row++) {
      const double t0 = fbt_value(table, row - 1, "t"), T = fbt_value(table, row, "t") - t0;
      const int n = (int)ceil(T / FBT_TOL(2e-5, 4e-5));
      double x[3];
      for (int k = 0; k < n; k++) {
        middle.drive[0].value[0] = (fb_real)(spin * (t0 + T * (k + 0.5) / n));
        input.drive[0].value[0] = (fb_real)(spin * (t0 + T * (k + 1.0) / n));
        FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &middle, &middle, &input, (fb_real)(T / n)),
                   FB_OK);
      }
      slider = fmax(slider, fabs((double)state.link[2].x[0] - fbt_value(table, row, "slider_x")));
      node_at(x, &state, 1, 2);
      mid = fmax(mid, hypot(x[0] - fbt_value(table, row, "mid_x"), x[1] - fbt_value(table, row, "mid_y")));
    }
    FBT_BELOW(slider, 4e-4 / (bending * bending));
    FBT_BELOW(mid, 1e-3 / (bending * bending));
    if (bending == 3) {
      fbt_figure("slider-crank with a flexible rod, its middle [m]", "p11_slider_crank.csv", mid);
    }
  }
}

/* E9.8, E9.10: a parallelogram passes its flat positions, where the loop's rows depend on each other: also exactly on
   them, driven or free, rocker and crank stay parallel. */
TEST(a_parallelogram_passes_its_flat_positions)
{
  for (int run = 0; run < 4; run++) {
    const double spin = 2.0, dt = FBT_TOL(pi / 4096, pi / 512), begin = run % 2 ? -100 * dt : -100.37 * dt;
    fb_system_input middle;
    double worst = 0.0, jump = 0.0;
    fourbar(0.5, 1.0, 0.5, 1.0, FB_JOINT_REVOLUTE);
    start[0].value[0] = start[2].value[0] = (fb_real)begin;
    start[1].value[0] = (fb_real)-begin;
    start[0].speed[0] = start[2].speed[0] = (fb_real)spin;
    start[1].speed[0] = (fb_real)-spin;
    if (run < 2) {
      desc.joint[0].mode[0] = FB_AXIS_PRESCRIBED;
      input.drive[0].value[0] = (fb_real)begin;
      input.drive[0].rate[0] = (fb_real)spin;
    }
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    middle = input;
    for (int step = 1; step <= FBT_TOL(8192, 1024); step++) { /* more than two turns: four or five flat positions */
      middle.drive[0].value[0] = (fb_real)(begin + spin * dt * (step - 0.5));
      input.drive[0].value[0] = (fb_real)(begin + spin * dt * step);
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &middle, &input, (fb_real)dt), FB_OK);
      worst = fmax(worst, fabs((double)(state.link[0].x[0] - state.link[2].x[0])));
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
      jump = fmax(jump, fabs((double)(motion.joint[2].speed[0] - motion.joint[0].speed[0])));
    }
    FBT_BELOW(worst, FBT_TOL(1e-8, 1e-2));
    FBT_BELOW(jump, FBT_TOL(1e-5, 5e-2));
    if (run == 3) {
      fbt_figure("parallelogram through its flat positions, rocker against crank [rad]", "parallel", worst);
    }
  }
}

/* A thin disc of radius 0.5 m on the plane z = 0: no slip along x and y, no height under the rim. */
static int disc_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  const double r = *(const double *)user;
  const double e[3] = {(double)pose->R[2], (double)pose->R[5], (double)pose->R[8]}, s = sqrt(1.0 - e[2] * e[2]);
  const fb_real arm[3] = {(fb_real)(r * e[2] * e[0] / s), (fb_real)(r * e[2] * e[1] / s), (fb_real)(-r * s)};
  FBT_TRUE(capacity >= 3);
  (void)t;
  for (int i = 0; i < 3; i++) {
    row[i].body[1] = FB_GROUND;
    row[i].force[0][i] = FB_R(1.0);
    fb_vec3_cross(row[i].torque[0], arm, row[i].force[0]);
    row[i].holonomic = i == 2;
    row[i].value = i == 2 ? pose->position[2] + arm[2] : 0;
  }
  return 3;
}

/* E9.10, E9.13, the caller's rows: a disc rolls round in a circle at constant tilt when W w3 sin(a) (C + m r^2) - A W^2
   sin(a) cos(a) + m g r cos(a) = 0, W its rate about the vertical, w3 about its axis, at a from the vertical
   (Newton-Euler about the contact point). */
TEST(a_disc_rolls_steadily)
{
  double r = 0.5;
  const double m = 2.0, tilt = 1.2, W = 1.7, A = 0.25 * m * r * r, C = 2.0 * A, g = 9.81;
  const double w3 = (A * W * W * sin(tilt) - m * g * r) * cos(tilt) / (W * sin(tilt) * (C + m * r * r));
  const double n = w3 - W * cos(tilt), spin[3] = {n * sin(tilt), 0, W + n * cos(tilt)};
  const double up[3] = {-r * cos(tilt), 0, r * sin(tilt)};
  const double v[3] = {spin[1] * up[2] - spin[2] * up[1], spin[2] * up[0] - spin[0] * up[2],
                       spin[0] * up[1] - spin[1] * up[0]};
  double before, worst = 0.0;
  fb_real R[9], vi[3], wi[3];
  fresh();
  body_desc.effects = FB_EFFECT_GRAVITY;
  body_desc.gravity[2] = -(fb_real)g;
  rigid(&model[0], m, 0, 0, 0, A, A, C);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  start[0].value[2] = (fb_real)(r * sin(tilt));
  turn(start[0].quat, 0, tilt, 0);
  fb_quat_to_mat33(R, start[0].quat);
  for (int i = 0; i < 3; i++) {
    vi[i] = (fb_real)v[i];
    wi[i] = (fb_real)spin[i];
  }
  fb_mat33_mulT_vec3(start[0].speed, R, vi);
  fb_mat33_mulT_vec3(start[0].speed + 3, R, wi);
  input.rows = disc_rows;
  input.user = &r;
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
  before = energy_of(&state);
  for (int k = 0; k < 2000; k++) {
    const fb_real *q = state.link[0].quat;
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(0.002)), FB_OK);
    worst = fmax(worst, fabs((double)(FB_R(1.0) - 2 * (q[1] * q[1] + q[2] * q[2])) - cos(tilt)));
  }
  FBT_BELOW(worst, FBT_TOL(1e-7, 1e-3));
  FBT_NEAR_REL(energy_of(&state), before, FBT_TOL(1e-9, 1e-3));
  fbt_figure("rolling disc, cosine of its tilt over 4 s", "steady rolling, closed form", worst);
}

/* No velocity across the x axis of user's body. */
static int knife_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  const int body = *(const int *)user;
  (void)capacity, (void)t;
  row->body[0] = body;
  row->body[1] = FB_GROUND;
  for (int i = 0; i < 3; i++) {
    row->force[0][i] = pose[body].R[3 * i + 1];
  }
  return 1;
}

/* E9.10, E9.4: a knife edge on a slope, on two massless slides and a hinge or on nothing: heading w t, x = g/(2 w^2) sin^2 w t,
   y = g/(2 w^2) (w t - sin(2 w t)/2), it does not slide down; slowly or a thousand times as fast. */
TEST(a_knife_edge_draws_a_cycloid)
{
  for (int run = 0; run < 4; run++) {
    const double hertz = run % 2 ? 1e3 : 1.0, g = 3.0 * hertz * hertz, w = 2.0 * hertz, dt = 0.002 / hertz;
    int knife = run / 2 ? 0 : 2;
    fresh();
    body_desc.base = FB_BASE_PRESCRIBED;
    rigid(&model[0], 0, 0, 0, 0, 0, 0, 0);
    rigid(&model[1], 1.5, 0, 0, 0, 0.1, 0.1, 0.2);
    if (knife == 0) {
      hang(0, 1, FB_JOINT_FREE, FB_GROUND, 0);
    } else {
      hang(0, 0, FB_JOINT_PRISMATIC, FB_GROUND, 0);
      hang(1, 0, FB_JOINT_PRISMATIC, 0, 0);
      hang(2, 1, FB_JOINT_REVOLUTE, 1, 0);
      turn(desc.joint[0].attitude, 0, pi / 2, 0);
      turn(desc.joint[0].child_attitude, 0, pi / 2, 0);
      turn(desc.joint[1].attitude, -pi / 2, 0, 0);
      turn(desc.joint[1].child_attitude, -pi / 2, 0, 0);
    }
    start[knife].speed[knife ? 0 : 5] = (fb_real)w;
    input.rows = knife_rows;
    input.user = &knife;
    input.n_load = 1;
    input.load[0].body = knife;
    input.load[0].load.force[0] = (fb_real)(1.5 * g);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    for (int k = 1; k <= 1000; k++) {
      const double t = dt * k;
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, (fb_real)dt), FB_OK);
      FBT_NEAR_ABS(state.link[0].x[0], g / (2 * w * w) * sin(w * t) * sin(w * t), FBT_TOL(1e-9, 1e-4));
      FBT_NEAR_ABS(knife ? state.link[1].x[0] : state.link[0].x[1], g / (2 * w * w) * (w * t - 0.5 * sin(2 * w * t)),
                   FBT_TOL(1e-9, 1e-4));
    }
  }
}

/* A wire through a point that moves away from body 1 at user's first two [m/s], turning at the third [rad/s]: body 0
   slides on it. About z it turns relative to the other at 0.5 + 0.8 t. */
static int wire_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  const double *const to = (const double *)user;
  const double time = (double)t, angle = to[2] * time, along[2] = {cos(angle), sin(angle)};
  const double across[2] = {-along[1], along[0]};
  FBT_TRUE(capacity >= 2);
  row[0].body[1] = row[1].body[1] = 1;
  row[0].holonomic = 1;
  for (int i = 0; i < 2; i++) {
    const double r = (double)pose[0].position[i] - (double)pose[1].position[i] - to[i] * time;
    row[0].force[0][i] = (fb_real)across[i];
    row[0].force[1][i] = -(fb_real)across[i];
    row[0].value += (fb_real)(across[i] * r);
    row[0].b -= (fb_real)(to[2] * along[i] * r + across[i] * to[i]);
  }
  for (int i = 0; i < 3; i++) { /* both turn about z */
    row[1].torque[0][i] = pose[0].R[3 * i + 2];
    row[1].torque[1][i] = -pose[1].R[3 * i + 2];
  }
  row[1].b = -(t * FB_R(0.8) + FB_R(0.5));
  return 2;
}

/* E9.10, E9.13, the caller's rows that move with time and with both bodies: on the turning wire s'' = w^2 s, s = s0
   cosh w t + s0'/w sinh w t; the center of mass goes straight on, and the spins share what is asked for. */
TEST(a_bead_is_flung_along_a_turning_wire)
{
  double to[3] = {0.2, -0.3, 3.0};
  const double w = to[2], m[2] = {2.0, 0.5}, J[2] = {0.3, 0.1}, s0 = 0.4, s0_dot = -0.5, T = 0.2;
  const double cm_rate[3] = {0.1, 0.7, -0.2}, z_rate = 0.6;
  const double first_rate[3] = {to[0] + s0_dot, to[1] + w * s0, z_rate}; /* body 0 relative to body 1 */
  fresh();
  for (int k = 0; k < 2; k++) {
    const double part = k == 0 ? m[1] / (m[0] + m[1]) : -m[0] / (m[0] + m[1]);
    rigid(&model[k], m[k], 0, 0, 0, J[k], J[k], J[k]);
    hang(k, k, FB_JOINT_FREE, FB_GROUND, 0);
    start[k].value[0] = (fb_real)(part * s0);
    for (int i = 0; i < 3; i++) {
      start[k].speed[i] = (fb_real)(cm_rate[i] + part * first_rate[i]);
    }
  }
  start[0].speed[5] = FB_R(0.5);
  input.rows = wire_rows;
  input.user = to;
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
  for (int k = 0; k <= 1; k++) {
    const double t = k * T, s = s0 * cosh(w * t) + s0_dot / w * sinh(w * t), c = cos(w * t), d = sin(w * t);
    const double s_dot = w * s0 * sinh(w * t) + s0_dot * cosh(w * t), spin = 0.5 + 0.8 * t;
    const double r[3] = {to[0] * t + s * c, to[1] * t + s * d, z_rate * t};
    const double v[3] = {to[0] + s_dot * c - w * s * d, to[1] + s_dot * d + w * s * c, z_rate};
    const double a[3] = {-2.0 * w * s_dot * d, 2.0 * w * s_dot * c, 0.0};
    const int n = FBT_TOL(200, 50);
    for (int step = 0; step < n && k == 1; step++) {
      fb_system_input middle = input, end = input;
      middle.t = (fb_real)((step + 0.5) * T / n);
      end.t = (fb_real)((step + 1) * T / n);
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &middle, &end, (fb_real)(T / n)), FB_OK);
      input = end;
    }
    memset(&work, 0xff, sizeof work); /* what is in it means nothing */
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    for (int body = 0; body < 2; body++) {
      const double part = body == 0 ? m[1] / (m[0] + m[1]) : -m[0] / (m[0] + m[1]);
      const double turns = body == 0 ? J[1] / (J[0] + J[1]) : -J[0] / (J[0] + J[1]);
      const double carried = J[0] * 0.5 / (J[0] + J[1]); /* of the spin that there was */
      fb_node_motion at;
      FBT_INT_EQ(fb_body_node_motion(&model[body], &at, &motion.pose[body], &motion.motion[body], 0), FB_OK);
      for (int i = 0; i < 3; i++) {
        FBT_NEAR_ABS(at.position[i], cm_rate[i] * t + part * r[i], FBT_TOL(1e-9, 1e-4));
        FBT_NEAR_ABS(at.velocity[i], cm_rate[i] + part * v[i], FBT_TOL(1e-8, 1e-3));
        FBT_NEAR_ABS(at.acceleration[i], part * a[i], FBT_TOL(1e-7, 1e-2));
      }
      FBT_NEAR_ABS(motion.motion[body].w[2], carried + turns * spin, FBT_TOL(1e-9, 1e-4));
      FBT_NEAR_ABS(motion.motion[body].w_dot[2], turns * 0.8, FBT_TOL(1e-9, 1e-3));
    }
  }
}

/* Holds node 1 of each of two bodies along the body's x axis, turned about z by user's [rad]. */
static int radial_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  const fb_real aside = *(const fb_real *)user;
  (void)capacity, (void)t;
  for (int k = 0; k < 2; k++) {
    row[k].body[0] = k;
    row[k].body[1] = FB_GROUND;
    row[k].node[0] = 1;
    for (int i = 0; i < 3; i++) {
      row[k].force[0][i] = pose[k].R[3 * i] + aside * pose[k].R[3 * i + 1];
    }
  }
  return 2;
}

/* E9.9: rows along which nothing can move, the tips of pendulums along their rods, are left out: what is left of them
   is rounding, and the pendulums swing as without them. 1e-10 rad aside (1e-5 in single precision) they count. */
TEST(rows_along_which_nothing_moves_are_left_out)
{
  fb_real aside = FB_R(0.0);
  fresh();
  body_desc.effects = FB_EFFECT_GRAVITY;
  body_desc.gravity[1] = -FB_R(9.81);
  rigid(&model[0], 1.0, 0.5, 0, 0, 0.01, 1.0 / 12.0, 1.0 / 12.0);
  for (int k = 0; k < 2; k++) {
    hang(k, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    turn(desc.joint[k].attitude, 0.3, -0.5, 0.7); /* no component is exact */
    start[k].speed[0] = (fb_real)(1 + k);
  }
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &kept, start, NULL), FB_OK);
  input.rows = radial_rows;
  input.user = &aside;
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
  for (int step = 0; step < 200; step++) {
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &kept, &work, NULL, NULL, NULL, FB_R(0.005)), FB_OK);
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(0.005)), FB_OK);
    FBT_INT_EQ(work.rank, 0);
  }
  for (int k = 0; k < 2; k++) {
    FBT_NEAR_ABS(state.link[k].x[0], kept.link[k].x[0], FBT_TOL(1e-13, 1e-5));
  }
  for (int counts = 0; counts < 2; counts++) {
    fresh(); /* without rounding: axes of the ground, the rod along x */
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    hang(1, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    aside = (fb_real)((counts ? 1.5 : 0.7) * FBT_TOL(1e-10, 1e-5));
    input.rows = radial_rows;
    input.user = &aside;
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, NULL, &input), FB_OK);
    FBT_INT_EQ(work.rank, counts ? 2 : 0);
  }
}

typedef struct sharp_pair {
  double angle, size[2]; /* [rad] between two directions, how long each is */
} sharp_pair;

static int sharp_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  const sharp_pair *const pair = (const sharp_pair *)user;
  (void)capacity, (void)t, (void)pose;
  row[0].body[1] = row[1].body[1] = FB_GROUND;
  row[0].force[0][0] = (fb_real)pair->size[0];
  row[1].force[0][0] = (fb_real)(pair->size[1] * cos(pair->angle));
  row[1].force[0][1] = (fb_real)(pair->size[1] * sin(pair->angle));
  return 2;
}

/* E9.9: a row is weighed with those of its kind at the same joint: at a ten-thousandth of a radian (a hundredth in
   single precision) two directions are one, five times that if one is five times as long, the first or the second; a
   heavy and a light body each have what holds them, and so have force and torque of a body whose inertia is next to
   nothing beside its mass. */
TEST(rows_are_weighed_with_their_kind)
{
  for (int run = 0; run < 6; run++) {
    const int counts = run % 2, longer = run / 2;
    sharp_pair pair = {sqrt((counts ? 1.5 : 0.7) * FBT_TOL(1e-8, 1e-4)), {1.0, 1.0}};
    if (longer > 0) {
      pair.angle *= 5.0;
      pair.size[longer - 1] = 5.0;
    }
    fresh();
    rigid(&model[0], 2.0, 0, 0, 0, 0.1, 0.1, 0.1);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    input.rows = sharp_rows;
    input.user = &pair;
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, NULL, &input), FB_OK);
    FBT_INT_EQ(work.rank, 1 + counts);
  }
  fresh();
  rigid(&model[0], 1e5, 0, 0, 0, 1e-5, 1e-5, 1e-5);
  rigid(&model[1], 1e-5, 0, 0, 0, 1e5, 1e5, 1e5);
  for (int k = 0; k < 2; k++) {
    hang(k, k, FB_JOINT_FREE, FB_GROUND, 0);
    close_loop(FB_JOINT_RIGID, FB_GROUND, 0, k, 0);
    start[k].speed[0] = start[k].speed[4] = FB_R(1.0);
  }
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
  FBT_INT_EQ(work.rank, 12);
  for (int k = 0; k < 2; k++) {
    for (int i = 0; i < 6; i++) { /* of the mass or the inertia times the speed that it had */
      FBT_NEAR_ABS(state.link[k].p[i], 0.0, FBT_TOL(1e-13, 1e-5) * ((i < 3) == (k == 0) ? 1e5 : 1e-5));
    }
  }
  for (int held = 0; held < 2; held++) { /* one by a loop, the other by the caller */
    sharp_pair across = {0.5 * pi, {1.0, 1.0}};
    fresh();
    hang(0, !held, FB_JOINT_FREE, FB_GROUND, 0);
    hang(1, held, FB_JOINT_FREE, FB_GROUND, 0);
    close_loop(FB_JOINT_RIGID, FB_GROUND, 0, 1, 0);
    input.rows = sharp_rows;
    input.user = &across;
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, NULL, &input), FB_OK);
    FBT_INT_EQ(work.rank, 8);
  }
}

typedef struct unlike_rows {
  double size; /* of both */
  int force;   /* row that is a force; the other one is a torque */
} unlike_rows;

static int force_and_torque_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  const unlike_rows *const unlike = (const unlike_rows *)user;
  (void)capacity, (void)t, (void)pose;
  for (int k = 0; k < 2; k++) { /* along x, about y; of one the ground is the first body, of the other the second */
    fb_row *at = &row[k];
    at->body[k] = FB_GROUND;
    (k == unlike->force ? &at->force[1 - k][0] : &at->torque[1 - k][1])[0] = (fb_real)unlike->size;
  }
  return 2;
}

/* E9.9: force and torque on one body, next to nothing of inertia beside its mass or the other way round, both hold it,
   whichever comes first and however long they are. */
TEST(force_and_torque_are_weighed_apart)
{
  for (int run = 0; run < 12; run++) {
    const double heavy = run % 2 ? 1e4 : 1e-4;
    unlike_rows unlike = {pow(1e-2, run / 4), run / 2 % 2};
    fresh();
    rigid(&model[0], heavy, 0, 0, 0, 1.0 / heavy, 1.0 / heavy, 1.0 / heavy);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    start[0].speed[0] = start[0].speed[4] = FB_R(1.0);
    input.rows = force_and_torque_rows;
    input.user = &unlike;
    init(FB_METHOD_RECURSIVE);
    memset(&work, 0xff, sizeof work); /* what is in it means nothing */
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    FBT_INT_EQ(work.rank, 2);
    FBT_NEAR_ABS(fbt_largest(state.link[0].p, 6), 0.0, FBT_TOL(1e-10, 1e-2));
  }
}

/* E9.17: what a loop misses counts against the size of the system, 1 m and how far out the farthest body is: one at the
   end of an arm, long or short, is brought to a point beside its circle, by a ten-billionth of the size and no more (a
   ten-thousandth in single precision). */
TEST(what_a_loop_misses_is_relative)
{
  for (int run = 0; run < 8; run++) {
    const int body = run & 1, beyond = run >> 1 & 1;
    const double arm = run & 4 ? 1e4 : 0.1, angle = 0.7;
    const double beside = arm + (1.0 + arm) * FBT_TOL(1e-10, 1e-4) * (beyond ? 1.5 : 0.8);
    fb_joint_desc *loop;
    fresh();
    rigid(&model[0], 1.0, 0, 0, 0, 1.0, 1.0, 1.0);
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    hang(1, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    desc.joint[body].child_position[0] = -(fb_real)arm;
    loop = close_loop(FB_JOINT_SPHERICAL, FB_GROUND, 0, body, 0);
    loop->position[0] = (fb_real)(beside * cos(angle));
    loop->position[1] = (fb_real)(beside * sin(angle));
    turn(loop->attitude, 0, 0, angle); /* rows along and across the arm */
    start[body].value[0] = (fb_real)(angle + 0.02);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL),
               beyond ? FB_ERR_CONTRADICTION : FB_OK);
    if (beyond) {
      FBT_INT_EQ(work.joint, 2);
    } else {
      FBT_NEAR_ABS(state.link[body].x[0], angle, FBT_TOL(1e-10, 1e-4));
    }
  }
}

/* E9.4, E9.10, E9.17: what cannot move is said with the joint's number, and nothing is changed. */
TEST(contradictions_name_their_joint)
{
  fourbar(0.4, 1.0, 0.8, 1.1, FB_JOINT_REVOLUTE); /* crank and rocker driven, against the loop */
  desc.joint[0].mode[0] = desc.joint[2].mode[0] = FB_AXIS_PRESCRIBED;
  start[0].value[0] = FB_R(0.7);
  start[2].value[0] = (fb_real)rocker_angle(0.4, 1.0, 0.8, 1.1, 0.7);
  start[1].value[0] = (fb_real)(atan2(0.8 * sin((double)start[2].value[0]) - 0.4 * sin(0.7),
                                      1.1 + 0.8 * cos((double)start[2].value[0]) - 0.4 * cos(0.7)) -
                                0.7);
  init(FB_METHOD_RECURSIVE);
  input.drive[0].value[0] = start[0].value[0];
  input.drive[2].value[0] = start[2].value[0];
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
  kept = state;
  input.drive[0].rate[0] = FB_R(0.01);
  input.drive[2].rate[0] = -FB_R(0.01);
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(0.001)),
             FB_ERR_CONTRADICTION);
  FBT_INT_EQ(work.joint, 3);
  FBT_TRUE(memcmp(&kept, &state, sizeof state) == 0);
  fourbar(0.4, 1.0, 0.8, 5.0, FB_JOINT_REVOLUTE); /* too far apart to close */
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_ERR_CONTRADICTION);
  FBT_INT_EQ(work.joint, 3);
  for (int method = 0; method < 2; method++) { /* a massless body at the end of a chain */
    fresh();
    rigid(&model[0], 1.0, 0.5, 0, 0, 0.1, 0.1, 0.1);
    rigid(&model[1], 0, 0, 0, 0, 0, 0, 0);
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    hang(1, 1, FB_JOINT_REVOLUTE, 0, 1);
    desc.method = (fb_method)method;
    FBT_INT_EQ(fb_system_init(&mechanism, &work, model, 2, &desc), FB_ERR_SINGULAR);
    FBT_INT_EQ(work.joint, 1);
  }
}

/* E3.2, E9.4: a free body without mass moves as it likes along a slide that it carries, and about a hinge, however the joint
   is turned: refused, in units of any size. With a hundred thousandth of the child's mass and inertia (single: a
   hundredth) it is a body. */
TEST(free_bodies_without_mass_are_refused_in_every_attitude)
{
  fbt_seed(43);
  for (int run = 0; run < 2000; run++) {
    static const double units[3] = {1.0, FBT_TOL(1e-10, 1e-5), FBT_TOL(1e10, 1e5)};
    const double unit = units[run % 3], part = run % 2 ? FBT_TOL(1e-5, 1e-2) : 0.0;
    const double m = unit * (1.0 + 0.5 * fbt_random()), j = 0.3 * m * (1.0 + 0.5 * fbt_random());
    fb_joint_desc *joint;
    fb_real turn[3];
    fb_status status;
    fresh();
    rigid(&model[0], part * m, 0, 0, 0, part * j, part * j, part * j);
    rigid(&model[1], m, 0.2 * fbt_random(), 0.2 * fbt_random(), 0.2 * fbt_random(), j, 1.2 * j, 0.9 * j);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    hang(1, 1, run / 2 % 2 ? FB_JOINT_REVOLUTE : FB_JOINT_PRISMATIC, 0, 0);
    joint = &desc.joint[1];
    fbt_fill(turn, 3, 3.0);
    fb_quat_from_rotvec(joint->attitude, turn);
    fbt_fill(turn, 3, 3.0);
    fb_quat_from_rotvec(joint->child_attitude, turn);
    fbt_fill(joint->position, 3, 0.5);
    fbt_fill(joint->child_position, 3, 0.5);
    desc.method = run / 4 % 2 ? FB_METHOD_DENSE : FB_METHOD_RECURSIVE;
    status = fb_system_init(&mechanism, &work, model, 2, &desc);
    FBT_INT_EQ(status, part > 0.0 ? FB_OK : FB_ERR_SINGULAR);
  }
}

/* Moves a body along x at 1 m/s, and at user's more [m/s]. */
static int disagreeing_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  (void)capacity, (void)pose, (void)t;
  row[0].body[1] = row[1].body[1] = FB_GROUND;
  row[0].force[0][0] = row[1].force[0][0] = FB_R(1.0);
  row[0].b = -FB_R(1.0);
  row[1].b = -FB_R(1.0) - *(const fb_real *)user;
  return 2;
}

/* E9.10: rows may contradict each other by a hundredth of the speed (a tenth in single precision), not by more. */
TEST(rows_may_disagree_by_a_hundredth)
{
  for (int run = 0; run < 4; run++) {
    const double part = FBT_TOL(0.01, 0.1);
    fb_real more = (fb_real)((run % 2 ? 1.4 : 0.7) * (run / 2 ? -part : part));
    fresh();
    rigid(&model[0], 2.0, 0, 0, 0, 1, 1, 1);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    input.rows = disagreeing_rows;
    input.user = &more;
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, NULL, &input),
               run % 2 ? FB_ERR_CONTRADICTION : FB_OK);
  }
}

typedef struct wrong_row {
  int count, row, what; /* rows, the one that is wrong, how */
} wrong_row;

/* Moves a body at (1, 2, 3) mm/s, and along x, half the same row, again. */
static int wrong_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  wrong_row *const wrong = (wrong_row *)user;
  fb_row *const at = &row[wrong->row];
  fb_real *const field[6] = {at->force[0], at->force[1], at->torque[0], at->torque[1], &at->b, &at->value};
  (void)capacity, (void)pose, (void)t;
  for (int k = 0; k < 4; k++) {
    row[k].body[1] = FB_GROUND;
    row[k].force[0][k % 3] = k < 3 ? FB_R(1.0) : FB_R(0.5);
    row[k].b = -FB_R(1e-3) * (fb_real)(k % 3 + 1) * row[k].force[0][k % 3];
  }
  if (wrong->what < 6) {
    *field[wrong->what] = (fb_real)NAN;
  } else if (wrong->what < 8) {
    at->body[wrong->what - 6] = 1;
  } else if (wrong->what < 10) {
    at->node[wrong->what - 8] = 2;
  } else if (wrong->what == 10) {
    at->b = FB_R(1e-3);
  } else if (wrong->what == 11) {
    wrong->count = 7 - wrong->count; /* 4 and 3 by turns */
  }
  return wrong->count;
}

/* E9.10, the caller's rows: what is wrong with one is said with its number, -2 - k, whichever it is: not a number, a
   body or node that there is not, against another one; and another number of rows than before. Nothing is wrong with
   one that says the same as another. */
TEST(wrong_rows_are_named)
{
  for (int what = 0; what < 13; what++) {
    for (int k = 0; k < 3; k += 2) {
      const fb_status expected = what < 6     ? FB_ERR_NOT_FINITE
                                 : what < 10  ? FB_ERR_CAPACITY
                                 : what == 10 ? FB_ERR_CONTRADICTION
                                 : what == 11 ? FB_ERR_VALUE
                                              : FB_OK;
      wrong_row wrong;
      wrong.count = 4;
      wrong.row = what == 10 ? 3 : k;
      wrong.what = what;
      fresh();
      rigid(&model[0], 1.0, 0, 0, 0, 1, 1, 1);
      hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
      input.rows = wrong_rows;
      input.user = &wrong;
      init(FB_METHOD_RECURSIVE);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, NULL, &input), expected);
      FBT_INT_EQ(work.joint, what < 11 ? -2 - wrong.row : -1);
      for (int i = 0; i < 3 && what == 12; i++) {
        FBT_NEAR_ABS(state.link[0].p[i], 1e-3 * (i + 1), FBT_TOL(1e-16, 1e-8));
      }
    }
  }
}

/* E9.16: speeds in, momenta out, the same speeds again; freed axes too. */
TEST(momenta_give_back_the_speeds)
{
  tree(FB_EFFECTS_FULL, 0);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
  for (int k = 0; k < desc.n_body; k++) {
    const int axes = mechanism.joint[k].n_axis;
    FBT_BELOW(fbt_difference(motion.joint[k].speed, start[k].speed, axes), FBT_TOL(1e-12, 1e-4));
    FBT_BELOW(fbt_difference(motion.motion[k].q_dot, start[k].q_dot, model[desc.model[k]].n), FBT_TOL(1e-12, 1e-3));
  }
}

/* E9.16, latches: a hinge locked in motion, and freed again: momenta stay, energy goes, the hinge stands, also with all
   joints kept. */
TEST(a_latch_conserves_momentum)
{
  for (int method = 0; method < 3; method += 2) {
    fb_momentum before, after;
    double energy;
    tree(FB_EFFECTS_FULL, 0);
    for (int k = 1; k < desc.n_body; k++) {
      memset(desc.joint[k].stiffness, 0, sizeof desc.joint[k].stiffness);
    }
    init((fb_method)method);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_momentum(&mechanism, model, &work, &before, &state, &input), FB_OK);
    energy = energy_of(&state);
    for (int joint = 1; joint < 4; joint++) {
      const fb_link_state hub = state.link[0];
      FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &work, &state, joint, 0, FB_AXIS_LOCKED, &input), FB_OK);
      FBT_TRUE(method != 0 || memcmp(hub.p, state.link[0].p, sizeof hub.p) == 0); /* bits: often latched, none lost */
      FBT_INT_EQ(fb_system_momentum(&mechanism, model, &work, &after, &state, &input), FB_OK);
      FBT_BELOW(fbt_difference(after.linear, before.linear, 3), FBT_TOL(1e-12, 1e-4));
      FBT_BELOW(fbt_difference(after.angular, before.angular, 3), FBT_TOL(1e-12, 1e-4));
      FBT_BELOW(energy_of(&state), energy);
      energy = energy_of(&state);
    }
    for (int k = 0; k < 100; k++) {
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(5e-4)), FB_OK);
    }
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    for (int joint = 1; joint < 4; joint++) {
      FBT_NEAR_ABS(motion.joint[joint].speed[0], 0.0, FBT_TOL(1e-12, 1e-4));
      if (joint < 3) {
        FBT_NEAR_ABS(motion.joint[joint].value[0], start[joint].value[0], FBT_TOL(1e-10, 1e-4));
      }
      FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &work, &state, joint, 0, FB_AXIS_FREE, &input), FB_OK);
    }
    FBT_NEAR_REL(energy_of(&state), energy, FBT_TOL(1e-8, 1e-3)); /* to free costs nothing */
    FBT_INT_EQ(fb_system_momentum(&mechanism, model, &work, &after, &state, &input), FB_OK);
    FBT_BELOW(fbt_difference(after.angular, before.angular, 3), FBT_TOL(1e-10, 1e-3));
  }
}

static unsigned tree_word(void)
{
  return fb_system_crc(&mechanism, model, FB_MAX_BODIES);
}

/* E8.40: of a system the word sees all but unused joints and the padding of the others, and its models. */
TEST(the_check_word_of_a_system_sees_every_byte)
{
  const int pad = (int)(sizeof(fb_joint) - 52 * sizeof(fb_real) - 11 * sizeof(int));
  unsigned word;
  int joints, most;
  tree(FB_EFFECTS_SPIN, 1);
  (void)close_loop(FB_JOINT_SPHERICAL, 4, 0, 6, 0);
  init(FB_METHOD_RECURSIVE);
  joints = mechanism.n_body + mechanism.n_loop;
  most = (int)sizeof(fb_joint) * (FBT_COUNT(mechanism.joint) - joints) + pad * (joints + 1) +
         2 * (int)sizeof(int) * (FB_MAX_BODIES - mechanism.n_body) + (int)(sizeof(fb_real) - sizeof(int));
  FBT_TRUE(pad < (int)sizeof(fb_real));
  FBT_TRUE(fbt_unseen(&mechanism, sizeof mechanism, tree_word) <= most);
  word = tree_word();
  for (int k = 0; k < 3; k++) {
    model[k].mass += FB_R(1.0);
    FBT_TRUE(tree_word() != word);
    model[k].mass -= FB_R(1.0);
  }
  FBT_INT_EQ(fb_system_crc(&mechanism, model, 2) == 0, 1); /* there is a third model */
  model[3] = model[2];
  mechanism.model[mechanism.n_body - 1] = 3;
  word = tree_word();
  model[3].mass += FB_R(1.0);
  FBT_TRUE(tree_word() != word);
  model[1].n = FB_MAX_MODES + 1;
  FBT_INT_EQ(tree_word() == 0, 1);
  FBT_INT_EQ(fb_system_crc(&mechanism, model, 1) == 0, 1); /* there are more models */
  FBT_INT_EQ(fb_system_crc(&mechanism, model, 0) == 0, 1);
  model[1].n = 0;
  for (int beyond = 0; beyond < 4; beyond++) {
    int *const count = beyond % 2 ? &mechanism.n_loop : &mechanism.n_body, was = *count;
    *count = beyond < 2 ? -1 : (beyond % 2 ? FB_MAX_LOOPS : FB_MAX_BODIES) + 1;
    FBT_INT_EQ(tree_word() == 0, 1);
    *count = was;
  }
}

/* A free body has no parent, whatever the desc says of one: the system is sound and has the same word. */
TEST(free_bodies_have_no_parent)
{
  unsigned word = 0;
  for (int said = 0; said < 2; said++) {
    fresh();
    flexible(&model[0], 1, 0, 0, FB_EFFECTS_FULL);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    hang(1, 0, FB_JOINT_FREE, said ? 0 : FB_GROUND, said);
    init(FB_METHOD_RECURSIVE);
    FBT_TRUE(!said || fb_system_crc(&mechanism, model, 1) == word);
    word = fb_system_crc(&mechanism, model, 1);
  }
}

/* E9.11, E9.14: the energy of a tree changes by the power of motors and loads less what dampers take, and motor_work by
   the motors' alone. */
TEST(springs_and_dampers_balance_energy)
{
  const double h = FBT_TOL(1e-4, 1e-2);
  double slope = 0.0, power = 0.0, motor = 0.0;
  tree(FB_EFFECTS_FULL, 1);
  fbt_seed(3);
  for (int k = 1; k < desc.n_body; k++) {
    for (int i = 0; i < 3; i++) {
      input.drive[k].torque[i] = (fb_real)fbt_random();
    }
  }
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_rates(&mechanism, model, &work, &rate, &state, &input), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
  for (int k = 1; k < desc.n_body; k++) {
    for (int i = 0; i < mechanism.joint[k].n_axis; i++) {
      const double u = (double)motion.joint[k].speed[i];
      motor += (double)input.drive[k].torque[i] * u;
      power -= (double)mechanism.joint[k].damping[i] * u * u;
    }
  }
  for (int side = -2; side <= 2; side++) {
    static const double weight[5] = {1.0 / 12, -2.0 / 3, 0, 2.0 / 3, -1.0 / 12};
    moved(&kept, &state, &rate, side * h);
    slope += weight[side + 2] / h * energy_of(&kept);
  }
  FBT_NEAR_ABS(slope, power + motor, FBT_TOL(1e-8, 1e-1));
  FBT_NEAR_ABS(rate.motor_work, motor, FBT_TOL(1e-12, 1e-4));
  FBT_NEAR_ABS(motion.power, motor, FBT_TOL(1e-12, 1e-4));
}

/* E9.19: the force of the joint at the root is the rate of the momentum of all that hangs on it, less gravity; at rest
   each joint carries the weight beyond it; an IMU at rest reads -g. */
TEST(joint_forces_carry_what_hangs_on_them)
{
  const double h = FBT_TOL(1e-4, 1e-2), g = 9.81, spin = 3.0;
  double F[3] = {0};
  fb_imu imu;
  fb_node_motion node;
  tree(FB_EFFECTS_FULL, 1);
  body_desc.gravity[2] = -(fb_real)g;
  body_desc.effects = FB_EFFECT_GRAVITY;
  rigid(&model[0], 3.0, 0.1, -0.05, 0.02, 0.3, 0.4, 0.5);
  flexible(&model[1], 2, 1, 1, FB_EFFECTS_FULL | FB_EFFECT_GRAVITY);
  rigid(&model[2], 0.7, 0.2, 0.1, -0.1, 0.03, 0.05, 0.04);
  desc.joint[0].kind = FB_JOINT_RIGID;
  desc.joint[0].parent = FB_GROUND;
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_rates(&mechanism, model, &work, &rate, &state, &input), FB_OK);
  for (int side = -2; side <= 2; side++) {
    static const double weight[5] = {1.0 / 12, -2.0 / 3, 0, 2.0 / 3, -1.0 / 12};
    fb_momentum at;
    moved(&kept, &state, &rate, side * h);
    FBT_INT_EQ(fb_system_momentum(&mechanism, model, &work, &at, &kept, &input), FB_OK);
    for (int i = 0; i < 3; i++) {
      F[i] += weight[side + 2] / h * (double)at.linear[i];
    }
  }
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
  for (int k = 0; k < desc.n_body; k++) {
    F[2] += (double)model[desc.model[k]].mass * g;
  }
  for (int i = 0; i < 3; i++) {
    FBT_NEAR_ABS(motion.joint[0].force[i], F[i], FBT_TOL(1e-8, 1e-1));
  }
  fresh(); /* a rod of 2 kg turned about the vertical at a constant rate, its mass center 0.4 m out */
  body_desc.gravity[2] = -(fb_real)g;
  body_desc.effects = FB_EFFECT_GRAVITY;
  rigid(&model[0], 2.0, 0.4, 0, 0, 0.01, 0.1, 0.1);
  hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
  desc.joint[0].mode[0] = FB_AXIS_PRESCRIBED;
  input.drive[0].rate[0] = (fb_real)spin;
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, NULL, &input), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
  FBT_NEAR_ABS(motion.joint[0].force[0], -2.0 * 0.4 * spin * spin, FBT_TOL(1e-13, 1e-5));
  FBT_NEAR_ABS(motion.joint[0].force[2], 2.0 * g, FBT_TOL(1e-13, 1e-5));
  FBT_NEAR_ABS(motion.joint[0].torque[1], -2.0 * g * 0.4, FBT_TOL(1e-13, 1e-5));
  FBT_NEAR_ABS(motion.motion[0].reaction_torque[1], -2.0 * g * 0.4, FBT_TOL(1e-13, 1e-5));
  FBT_INT_EQ(fb_body_node_motion(&model[0], &node, &motion.pose[0], &motion.motion[0], 1), FB_OK);
  fb_imu_eval(&imu, &node, body_desc.gravity); /* at 0.8 m */
  FBT_NEAR_ABS(imu.specific_force[0], -0.8 * spin * spin, FBT_TOL(1e-13, 1e-5));
  FBT_NEAR_ABS(imu.specific_force[2], g, FBT_TOL(1e-13, 1e-5));
  FBT_NEAR_ABS(imu.angular_rate[2], spin, FBT_TOL(1e-13, 1e-6));
}

/* E9.20: turned back into inertial axes what an IMU reads is acceleration less gravity, and the angular rate. */
TEST(an_imu_reads_in_its_own_axes)
{
  for (int falls = 0; falls < 2; falls++) {
    fb_node_motion node;
    fb_imu imu;
    fb_real gravity[3], R[9], a[3], w[3];
    memset(&node, 0, sizeof node);
    turn(node.quat, 0.4, -0.7, 0.9);
    fb_quat_to_mat33(R, node.quat);
    fbt_fill(gravity, 3, 9.0);
    fbt_fill(node.acceleration, 3, 5.0);
    fbt_fill(node.angular_rate, 3, 2.0);
    fb_imu_eval(&imu, &node, falls ? NULL : gravity);
    fb_mat33_mul_vec3(a, R, imu.specific_force);
    fb_mat33_mul_vec3(w, R, imu.angular_rate);
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(a[i], node.acceleration[i] - (falls ? FB_R(0.0) : gravity[i]), FBT_TOL(1e-14, 1e-5));
      FBT_NEAR_ABS(w[i], node.angular_rate[i], FBT_TOL(1e-14, 1e-5));
    }
  }
}

/* A quaternion's turn of a vector. */
static void turned(double y[3], const fb_real quat[4], const double x[3])
{
  fb_real R[9], a[3], b[3];
  for (int i = 0; i < 3; i++) {
    a[i] = (fb_real)x[i];
  }
  fb_quat_to_mat33(R, quat);
  fb_mat33_mul_vec3(b, R, a);
  for (int i = 0; i < 3; i++) {
    y[i] = (double)b[i];
  }
}

/* E9.1, E9.2, E9.7, E9.14: for every kind of joint the frame on the child sits on that of the parent, moved and turned
   by the coordinates as the header says, by quaternions. */
TEST(every_joint_moves_as_it_should)
{
  for (int kind = (int)FB_JOINT_RIGID; kind <= (int)FB_JOINT_SPHERICAL; kind++) {
    fb_real frame[4], child[4], rel[4], two[4], all[4], back[4];
    double origin[3], out[3], shift[3] = {0}, axis[3] = {0, 0, 1}, miss = 0.0, angle = 0.4, slide = 0.0;
    fb_joint_desc *j;
    fresh();
    fbt_seed((unsigned)kind);
    rigid(&model[0], 1.0, 0.3, 0, 0, 1, 1, 1);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    hang(1, 0, (fb_joint_kind)kind, 0, 1);
    j = &desc.joint[1];
    turn(j->attitude, 0.3, -0.5, 0.7);
    turn(j->child_attitude, -0.2, 0.4, 0.1);
    for (int i = 0; i < 3; i++) {
      j->position[i] = (fb_real)(0.2 + 0.1 * i);
      j->child_position[i] = (fb_real)(0.1 - 0.2 * i);
    }
    j->pitch = FB_R(0.25);
    start[1].value[0] = FB_R(0.4);
    start[1].value[1] = -FB_R(0.3);
    turn(start[1].quat, 0.2, 0.5, -0.4);
    turn(start[0].quat, 0.1, 0.2, 0.3);
    start[0].value[0] = FB_R(1.0);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    slide = kind == FB_JOINT_PRISMATIC ? 0.4 : kind == FB_JOINT_CYLINDRICAL ? -0.3 : kind == FB_JOINT_SCREW ? 0.1 : 0.0;
    angle = kind == FB_JOINT_PRISMATIC || kind == FB_JOINT_RIGID ? 0.0 : angle;
    turn(rel, 0, 0, angle);
    turn(two, kind == FB_JOINT_UNIVERSAL ? -0.3 : 0.0, 0, 0);
    fb_quat_mul(all, rel, two);
    memcpy(rel, kind == FB_JOINT_SPHERICAL ? start[1].quat : all, sizeof rel);
    fb_quat_mul(frame, motion.pose[0].quat, j->attitude); /* joint frame of the parent */
    fb_quat_mul(child, frame, rel);
    back[0] = j->child_attitude[0];
    for (int i = 1; i < 4; i++) {
      back[i] = -j->child_attitude[i];
    }
    fb_quat_mul(all, child, back); /* attitude of the child */
    for (int i = 0; i < 3; i++) {
      shift[i] = (double)(model[0].node[1].r[i] + j->position[i]);
    }
    turned(origin, motion.pose[0].quat, shift);
    turned(out, frame, axis);
    for (int i = 0; i < 3; i++) {
      origin[i] += (double)motion.pose[0].rho[i] + slide * out[i];
      shift[i] = (double)j->child_position[i];
    }
    turned(out, motion.pose[1].quat, shift);
    for (int i = 0; i < 3; i++) {
      miss = fmax(miss, fabs(origin[i] - out[i] - (double)motion.pose[1].rho[i]));
    }
    FBT_BELOW(miss, FBT_TOL(1e-14, 1e-6));
    FBT_NEAR_ABS(fabs((double)(all[0] * motion.pose[1].quat[0] + fb_vec3_dot(all + 1, motion.pose[1].quat + 1))), 1.0,
                 FBT_TOL(1e-14, 1e-6));
  }
}

/* E9.2: joint frames half a turn from the child's, whose matrices have no element off the diagonal: the child stands
   half a turn from the parent. */
TEST(joint_frames_may_be_half_a_turn_off)
{
  for (int axis = 0; axis < 3; axis++) {
    fresh();
    rigid(&model[0], 1.0, 0.3, 0, 0, 1, 1, 1);
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    desc.joint[0].child_attitude[1 + axis] = FB_R(1.0);
    for (int method = 0; method < 3; method++) {
      init((fb_method)method);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, NULL, NULL), FB_OK);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
      FBT_NEAR_ABS(fabs((double)motion.pose[0].quat[1 + axis]), 1.0, FBT_TOL(1e-15, 1e-6));
    }
  }
}

/* E9.2: what hangs on a node that only turns, the tip of a beam with torsion alone, turns with it. */
TEST(a_node_that_only_turns_carries_its_body)
{
  fb_node_motion tip;
  fresh();
  flexible(&model[0], 0, 0, 1, FB_EFFECTS_FULL);
  rigid(&model[1], 1.0, 0, 0, 0, 1, 1, 1);
  hang(0, 0, FB_JOINT_RIGID, FB_GROUND, 0);
  hang(1, 1, FB_JOINT_RIGID, 0, 1);
  start[0].q[0] = FB_R(0.01);
  start[0].q_dot[0] = FB_R(0.02);
  for (int method = 0; method < 3; method++) {
    init((fb_method)method);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    FBT_INT_EQ(fb_body_node_motion(&model[0], &tip, &motion.pose[0], &motion.motion[0], 1), FB_OK);
    FBT_TRUE(fabs((double)tip.quat[1]) > 1e-3);
    FBT_BELOW(fbt_difference(motion.pose[1].quat, tip.quat, 4), FBT_TOL(1e-14, 1e-6));
    FBT_BELOW(fbt_difference(motion.motion[1].w, tip.angular_rate, 3), FBT_TOL(1e-14, 1e-6));
  }
}

/* E9.2: what hangs on a node that one mode moves or turns in one direction alone goes along with it. */
TEST(nodes_that_move_in_one_way_carry_their_bodies)
{
  for (int way = 0; way < 12; way++) { /* first or second mode, x, y or z, displacement or rotation */
    const fb_real r[3] = {FB_R(0.5), FB_R(0.2), -FB_R(0.1)}, mass[6] = {FB_R(1.0), 0, 0, 0, FB_R(1.0), 0};
    fb_real psi[6] = {0}, theta[6] = {0};
    fb_node_motion at;
    fb_body_desc d;
    int node;
    fresh();
    d = body_desc;
    d.base = FB_BASE_PRESCRIBED;
    d.effects = FB_EFFECTS_SPIN;
    d.deflection_limit = FB_R(1.0);
    (way < 6 ? psi : theta)[way % 6] = FB_R(1.0);
    rigid(&model[1], 1.0, 0.1, 0, 0, 1, 1, 1);
    FBT_INT_EQ(fb_shape_init(&shape, 2), FB_OK);
    FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(2.0), r, mass, NULL), FB_OK);
    FBT_INT_EQ(fb_shape_add_node(&shape, &node, r, psi, theta), FB_OK);
    FBT_INT_EQ(fb_body_init(&model[0], &body_work, &shape, &d), FB_OK);
    hang(0, 0, FB_JOINT_RIGID, FB_GROUND, 0);
    hang(1, 1, FB_JOINT_RIGID, 0, 1);
    start[0].q[way % 6 / 3] = FB_R(0.01);
    start[0].q_dot[way % 6 / 3] = FB_R(0.02);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    FBT_INT_EQ(fb_body_node_motion(&model[0], &at, &motion.pose[0], &motion.motion[0], 1), FB_OK);
    FBT_NEAR_REL(way < 6 ? motion.motion[1].v[way % 3] : motion.motion[1].w[way % 3], 0.02, 1e-4);
    FBT_BELOW(fbt_difference(motion.pose[1].rho, at.position, 3), FBT_TOL(1e-14, 1e-6));
    FBT_BELOW(fbt_difference(motion.pose[1].quat, at.quat, 4), FBT_TOL(1e-14, 1e-6));
  }
}

/* Lowest frequencies [rad/s] of a system at rest: the mass matrix from the momenta of unit speeds, K of the modes. */
static void system_frequencies(double *omega, int count)
{
  static fb_real M[FB_MAX_SPEEDS * FB_MAX_SPEEDS], K[FB_MAX_SPEEDS * FB_MAX_SPEEDS], X[FB_MAX_SPEEDS * FB_MAX_SPEEDS];
  static fb_real d[FB_MAX_SPEEDS];
  int N = 0;
  for (int k = 0; k < desc.n_body; k++) {
    N += model[desc.model[k]].n;
  }
  memset(K, 0, sizeof K);
  for (int k = 0, c = 0; k < desc.n_body; k++) {
    for (int a = 0; a < model[desc.model[k]].n; a++, c++) {
      memset(start, 0, sizeof start);
      start[k].q_dot[a] = FB_R(1.0);
      for (int b = 0; b < modes.n; b++) {
        K[c * N + c - a + b] = modes.K[a * modes.n + b];
      }
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
      for (int j = 0, r = 0; j < desc.n_body; j++) {
        for (int b = 0; b < model[desc.model[j]].n; b++, r++) {
          M[r * N + c] = state.link[j].pi[b];
        }
      }
    }
  }
  FBT_INT_EQ(fb_eig_gen_solve(d, X, K, M, N), FB_OK);
  for (int i = 0; i < count; i++) {
    omega[i] = sqrt((double)d[i]);
  }
  memset(start, 0, sizeof start);
}

/* A cantilever of length 1 cut into `parts`, two constraint modes and `bending` modes each. */
static void cut_beam(int parts, int bending)
{
  fresh();
  memset(&beam_desc, 0, sizeof beam_desc);
  body_desc.effects = FB_EFFECTS_SPIN;
  {
    static fb_modes_desc keep;
    int node;
    memset(&keep, 0, sizeof keep);
    beam_desc.length = (fb_real)(1.0 / parts);
    beam_desc.n_element = 6;
    beam_desc.n_station = 1;
    beam_desc.station[0].mass = FB_R(1.0);
    beam_desc.station[0].EI_z = FB_R(1.0);
    keep.basis = FB_BASIS_COMPONENT; /* what the next part does to the tip bends it exactly */
    keep.n_boundary = 2;
    keep.boundary[0].node = keep.boundary[1].node = 6;
    keep.boundary[0].axis = 1;
    keep.boundary[1].axis = 5;
    keep.count[FB_KIND_BEND_Y] = bending;
    body_desc.base = FB_BASE_PRESCRIBED;
    FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
    FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, (fb_real)(1.0 / parts)), FB_OK);
    FBT_INT_EQ(fb_body_init(&model[0], &body_work, &shape, &body_desc), FB_OK);
  }
  for (int k = 0; k < parts; k++) {
    hang(k, 0, FB_JOINT_RIGID, k - 1, k > 0);
  }
  init(FB_METHOD_RECURSIVE);
}

/* Largest difference of the tip's motion from that of the clamped beam's exact modes, after a small force on the tip is
   let go: y = sum of a_k cos(omega_k t), over the static deflection. */
static double cut_transient(int parts)
{
  static const double beta[] = {1.8751040687119611, 4.6940911329741746, 7.8547574382376126, 10.995540734875467,
                                14.13716839104647};
  const double dt = 2e-4, F = 1e-3;
  double worst = 0.0;
  fb_system_input pull;
  memset(&pull, 0, sizeof pull);
  pull.n_load = 1;
  pull.load[0].body = parts - 1;
  pull.load[0].load.node = 1;
  pull.load[0].load.force[1] = (fb_real)F;
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, NULL, NULL), FB_OK);
  for (int step = 1; step <= 4000; step++) { /* the force comes on at t = 0: y = sum a_k (1 - cos) */
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &pull, &pull, &pull, (fb_real)dt), FB_OK);
    if (step % 20 == 0) {
      double x[3], y = 0.0;
      for (int k = 0; k < 5; k++) {
        const double w = beta[k] * beta[k];
        y += F * 4.0 / (w * w) * (1.0 - cos(w * dt * step)); /* psi(1) = 2 of the normalized mode */
      }
      node_at(x, &state, parts - 1, 1);
      worst = fmax(worst, fabs(x[1] - y) / (F / 3.0));
    }
  }
  return worst;
}

/* E9.12: one beam cut into two, three and four bodies joined rigidly is the uncut one within the truncation error,
   which falls as modes are added: frequencies and the response to a force. */
TEST(a_cut_beam_behaves_as_the_whole)
{
  static const double exact[] = {3.5160152685, 22.034491530, 61.697214402};
  for (int parts = 2; parts <= 4; parts++) {
    double before[3] = {1, 1, 1}, transient = 1.0;
    for (int bending = 0; bending <= 2; bending++) {
      double omega[3], response;
      cut_beam(parts, bending);
      system_frequencies(omega, 3);
      response = cut_transient(parts);
      for (int k = 0; k < 3; k++) {
        const double error = omega[k] / exact[k] - 1.0;
        FBT_TRUE(error > -FBT_TOL(1e-6, 1e-3)); /* Ritz: from above */
        FBT_BELOW(error, before[k]);
        before[k] = fmax(error, FBT_TOL(1e-6, 1e-3));
      }
      FBT_BELOW(response, transient);
      transient = FB_SINGLE ? 1.0 : response;
      if (bending == 2 && parts == 4) {
        fbt_figure("cantilever cut into four bodies, third frequency", "closed form", fabs(omega[2] / exact[2] - 1.0));
        fbt_figure("the same, response to a force on the tip [static deflections]", "closed form", response);
      }
    }
  }
}

/* E11.12: the limit is that of the undeformed linkage at zero coordinates: a body on a sprung ball joint, its center c further
   out, on one that turns freely about z, det(K - omega^2 M) = 0 with M of the two angles about z. */
TEST(the_limit_of_a_linkage_is_in_closed_form)
{
  const double k = 300.0, L = 0.4, h = 0.5, c = 0.3, m = 2.0, J = 0.02, J0 = 0.1;
  const double M[3] = {J0 + m * (L * L + (h + c) * (h + c)) + J, m * c * (h + c) + J, m * c * c + J};
  const double omega = sqrt(k * M[0] / (M[0] * M[2] - M[1] * M[1]));
  double limit;
  fresh();
  rigid(&model[0], 1.0, 0, 0, 0, 1.0, 1.0, J0);
  rigid(&model[1], m, 0, c, 0, 5.0, 5.0, J);
  hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
  hang(1, 1, FB_JOINT_SPHERICAL, 0, 0);
  desc.joint[1].position[0] = (fb_real)L;
  desc.joint[1].position[1] = (fb_real)h;
  for (int i = 0; i < 3; i++) {
    desc.joint[1].stiffness[i] = (fb_real)k;
  }
  init(FB_METHOD_RECURSIVE);
  limit = (double)fb_system_rk4_limit(&mechanism, model, 0, 0);
  FBT_NEAR_REL(limit, 2.785 / (sqrt(1.05) * omega), FBT_TOL(1e-9, 1e-4)); /* 5 % on omega^2 */
}

/* E11.12: the limit is that of the fastest, whichever body it is: one of a row on the ground, each on springs, rigid
   (sqrt(k/J), J about one axis less than about the others; stiff or soft) or a clamped beam (the highest mode and its
   damping). */
TEST(the_limit_finds_the_fastest_body)
{
  for (int bends = 0; bends < 2; bends++) {
    for (int fast = 0; fast < FB_MAX_BODIES; fast++) {
      for (int axis = 0; axis < 3 - bends; axis++) {
        const double k = axis == 1 ? 1e-3 : 300.0, J[3] = {0.5, 0.6, 0.7}, less = 0.2;
        double omega = sqrt(k / less), g = 0.0;
        fresh();
        rigid(&model[0], 1.0, 0, 0, 0, J[0], J[1], J[2]);
        rigid(&model[1], 1.0, 0, 0, 0, axis == 0 ? less : J[0], axis == 1 ? less : J[1], axis == 2 ? less : J[2]);
        if (bends) {
          for (int a = 0; a < 5; a++) {
            body_desc.zeta[a] = FB_R(0.2);
          }
          flexible(&model[1], 2, 2, 1, axis ? FB_EFFECTS_FULL | FB_EFFECT_DAMPING : FB_EFFECTS_FULL);
          omega = fbt_largest(modes.omega, modes.n);
          g = axis ? 0.5 * 1.05 * 2.0 * 0.2 * omega : 0.0;
        }
        for (int j = 0; j < FB_MAX_BODIES; j++) {
          hang(j, j == fast, bends ? FB_JOINT_RIGID : FB_JOINT_SPHERICAL, FB_GROUND, 0);
          desc.joint[j].stiffness[0] = (fb_real)k;
        }
        init(FB_METHOD_RECURSIVE);
        FBT_NEAR_REL(fb_system_rk4_limit(&mechanism, model, 0, 0), 2.785 / (g + sqrt(g * g + 1.05 * omega * omega)),
                     FBT_TOL(1e-9, 1e-4));
      }
    }
  }
}

/* E11.12: where neighbors swing against each other: a slide of mass M carries two alike, one pointing the other way,
   rods on hinges (I about them, moment of mass s) or beams in their first mode (I = 1, s its momentum); the fastest
   mode moves the slide, omega^2 = k/(I - 2 s^2/M). */
TEST(the_limit_finds_neighbors_against_each_other)
{
  for (int bends = 0; bends < 2; bends++) {
    const double m = 1.0, out = 0.5, J = 0.1, slide = 2.0;
    double k = 50.0, I = J + m * out * out, s = m * out, M = slide + 2.0 * m;
    fresh();
    rigid(&model[0], slide, 0, 0, 0, 1, 1, 1);
    rigid(&model[1], m, out, 0, 0, J, J, J);
    if (bends) {
      flexible(&model[1], 1, 0, 0, FB_EFFECTS_FULL);
      k = (double)(modes.omega[0] * modes.omega[0]);
      I = 1.0;
      s = (double)shape.P[1];
      M = slide + 2.0 * (double)shape.mass;
    }
    hang(0, 0, FB_JOINT_PRISMATIC, FB_GROUND, 0);
    turn(desc.joint[0].attitude, -pi / 2, 0, 0); /* along y */
    turn(desc.joint[0].child_attitude, -pi / 2, 0, 0);
    for (int j = 1; j < 3; j++) {
      hang(j, 1, bends ? FB_JOINT_RIGID : FB_JOINT_REVOLUTE, 0, 0);
      turn(desc.joint[j].attitude, 0, 0, j == 1 ? 0.0 : pi);
      desc.joint[j].stiffness[0] = (fb_real)k;
    }
    init(FB_METHOD_RECURSIVE);
    FBT_NEAR_REL(fb_system_rk4_limit(&mechanism, model, 0, 0), 2.785 / sqrt(1.05 * k / (I - 2.0 * s * s / M)),
                 FBT_TOL(1e-9, 1e-4));
  }
}

/* E11.12: axes that are prescribed do not count with their springs and dampers: what swings on them does, (c, k)/J
   about its hinge; with all joints kept it is (c, k) (1/J_0 + 1/J_1) of two that turn freely, and the spring to the
   ground. */
TEST(what_is_prescribed_has_no_limit)
{
  const double k[2] = {700.0, 300.0}, c[2] = {3.0, 2.0}, J[2] = {0.4, 0.1}, m = 2.0, out = 0.3;
  for (int run = 0; run < 6; run++) {
    const int given = run % 2; /* a hinge, or a free body */
    const fb_method method = (fb_method)(run / 2);
    double stiff = 1.05 * k[1] / (J[1] + m * out * out), damped = 1.05 * c[1] / (J[1] + m * out * out), g;
    fresh();
    rigid(&model[0], 3.0, 0, 0, 0, 0.2, 0.3, J[0]);
    rigid(&model[1], m, out, 0, 0, 0.2, 0.3, J[1]);
    hang(0, 0, given ? FB_JOINT_FREE : FB_JOINT_REVOLUTE, FB_GROUND, 0);
    hang(1, 1, FB_JOINT_REVOLUTE, 0, 0);
    desc.joint[1].position[1] = FB_R(0.5);
    desc.joint[0].mode[0] = FB_AXIS_PRESCRIBED;
    for (int j = given; j < 2; j++) {
      desc.joint[j].stiffness[0] = (fb_real)k[j];
      desc.joint[j].damping[0] = (fb_real)c[j];
    }
    if (method == FB_METHOD_MULTIPLIERS) {
      const double apart = given ? 1.0 / J[1] : 1.0 / J[0] + 1.0 / J[1], ground = given ? 0.0 : 1.0 / J[0];
      stiff = k[1] * apart + k[0] * ground;
      damped = c[1] * apart + c[0] * ground;
    }
    g = 0.5 * damped;
    init(method);
    FBT_NEAR_REL(fb_system_rk4_limit(&mechanism, model, 0, 0), 2.785 / (g + sqrt(g * g + stiff)), FBT_TOL(1e-9, 1e-4));
  }
}

/* E11.15: at the limit a rod on a spring is stable, beyond it the step is refused and the state stays. */
TEST(system_steps_beyond_the_limit_are_refused)
{
  const double k = 400.0, J = 1.0 / 3.0, omega = sqrt(k / J);
  fb_real limit;
  fresh();
  rigid(&model[0], 1.0, 0.5, 0, 0, 0, 1.0 / 12.0, 1.0 / 12.0);
  hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
  desc.joint[0].stiffness[0] = (fb_real)k;
  start[0].value[0] = FB_R(0.001);
  init(FB_METHOD_RECURSIVE);
  limit = fb_system_rk4_limit(&mechanism, model, 0, 0);
  FBT_NEAR_REL(limit, 2.785 / omega, 0.05);
  FBT_BELOW(limit, 2.785 / omega);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
  kept = state;
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, FB_R(1.05) * limit), FB_ERR_STEP);
  FBT_TRUE(memcmp(&kept, &state, sizeof state) == 0);
  for (int step = 0; step < 1000; step++) {
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, FB_R(0.9) * limit), FB_OK);
  }
  FBT_BELOW(fabs((double)state.link[0].x[0]), 0.001);
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, -limit), FB_ERR_VALUE);
}

/* E4.5: a body's attitude comes back from its matrix as the unit quaternion with w >= 0, whichever component is largest;
   from the tree and from the poses of a system that keeps all joints. */
TEST(attitudes_come_back_as_they_were)
{
  for (int method = 0; method < 3; method += 2) {
    fresh();
    rigid(&model[0], 1.0, 0.1, 0, 0, 1.0, 1.0, 1.0);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    init((fb_method)method);
    fbt_seed(11);
    for (int trial = 0; trial < 50; trial++) {
      fb_real q[4], given[4];
      fbt_fill(q, 4, 1.0);
      q[0] = trial < 5 ? FB_R(0.0) : q[0]; /* half turns, too */
      memcpy(given, q, sizeof q);
      FBT_INT_EQ(fb_quat_normalize(q), FB_OK);
      for (int i = 0; i < 4; i++) { /* of any length */
        start[0].quat[i] = trial % 2 ? q[i] : given[i] * (fb_real)(1 << trial % 8) / FB_R(16.0);
      }
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
      for (int i = 0; i < 4; i++) {
        const fb_real sign = q[0] * motion.pose[0].quat[0] + fb_vec3_dot(q + 1, motion.pose[0].quat + 1);
        FBT_NEAR_ABS(motion.pose[0].quat[i], sign < FB_R(0.0) ? -q[i] : q[i], 8.0 * (double)FB_EPSILON);
      }
      FBT_TRUE(motion.pose[0].quat[0] >= FB_R(0.0));
    }
  }
}

/* E9.6: a rod whose only mode is its first of stretch, psi = sqrt(2/m) at the tip, carries a body there: omega^2 =
   omega_1^2/(1 + 2 m_tip/m), which the limit shows. */
TEST(a_stretching_rod_carries_its_neighbor)
{
  const double EA = 2e4, m = 0.5, m_tip = 3.0;
  const double omega = 0.5 * pi * sqrt(EA / m) / sqrt(1.0 + 2.0 * m_tip / m);
  fresh();
  link_beam(&model[0], 1.0, m, 2.0, EA, 0, 1, 1.0);
  rigid(&model[1], m_tip, 0, 0, 0, 1.0, 1.0, 1.0);
  hang(0, 0, FB_JOINT_RIGID, FB_GROUND, 0);
  hang(1, 1, FB_JOINT_RIGID, 0, 1);
  init(FB_METHOD_RECURSIVE);
  FBT_NEAR_REL(fb_system_rk4_limit(&mechanism, model, 0, 0), 2.785 / omega, 0.05);
}

/* Stiff cubic elements with nonlinear strain on a hub, free: 1 m, bending along y, z or both, and stretch. */
static void strained(fb_body *body, int n_element, int y, int z)
{
  const fb_real root[3] = {0}, inertia[6] = {FB_R(0.2), FB_R(0.2), FB_R(0.2), 0, 0, 0};
  fb_modes_desc keep;
  fb_body_desc d = body_desc;
  int tip;
  memset(&keep, 0, sizeof keep);
  beam_desc.length = FB_R(1.0);
  beam_desc.n_element = n_element;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = FB_R(0.8);
  beam_desc.station[0].EA = FB_R(2e4);
  beam_desc.station[0].EI_y = FB_R(3.0);
  beam_desc.station[0].EI_z = FB_R(2.0);
  keep.basis = FB_BASIS_FUNCTIONS;
  keep.count[FB_KIND_BEND_Y] = y ? FB_ALL_MODES : 0;
  keep.count[FB_KIND_BEND_Z] = z ? FB_ALL_MODES : 0;
  keep.count[FB_KIND_AXIAL] = FB_ALL_MODES;
  keep.root_strain = 1;
  d.effects = FB_EFFECTS_STRAIN;
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(2.0), root, inertia), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_strain(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &tip, 0, &beam, &modes, FB_R(1.0)), FB_OK);
  FBT_INT_EQ(fb_body_init(body, &body_work, &shape, &d), FB_OK);
}

/* E11.13, E8.29: about a beam that a load at its tip pulls, bent and straight, the matrix of a step has the stiffness of
   that state: one iteration of a step of half a period is as good as twenty. */
TEST(one_iteration_is_enough_about_a_stretched_beam)
{
  static fb_system_state end[2];
  for (int aside = 0; aside < 2; aside++) {
    double size, miss;
    fresh();
    desc.allow_long_step = 1;
    strained(&model[0], 1, 1, 1);
    hang(0, 0, FB_JOINT_RIGID, FB_GROUND, 0);
    init(FB_METHOD_RECURSIVE);
    input.n_load = 1;
    input.load[0].load.node = 1;
    input.load[0].load.force[0] = FB_R(300.0);
    input.load[0].load.force[1] = (fb_real)(40.0 * aside);
    input.load[0].load.force[2] = (fb_real)(25.0 * aside);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, NULL, NULL), FB_OK);
    for (int step = 0; step < 400; step++) {
      FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, FB_R(0.05), 20), FB_OK);
    }
    for (int k = 0; k < 2; k++) {
      end[k] = state;
      for (int a = 0; a < model[0].n; a++) {
        end[k].link[0].pi[a] += (fb_real)(FBT_TOL(1e-6, 1e-3) * (a + 1));
      }
      FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &end[k], &work, &input, &input, FB_R(0.2), k ? 20 : 1), FB_OK);
    }
    size = fbt_difference(end[1].link[0].q, state.link[0].q, model[0].n);
    miss = fbt_difference(end[0].link[0].q, end[1].link[0].q, model[0].n);
    FBT_BELOW(miss, FBT_TOL(1e-4, 2e-2) * size);
  }
}

/* What one and two of Newton's iterations leave of a step of such elements. */
static void strained_left(double left[2], int n_element, int y, int z)
{
  static fb_system_state end[3];
  const int iterations[3] = {1, 2, 20};
  fresh();
  strained(&model[0], n_element, y, z);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  desc.allow_long_step = 1;
  init(FB_METHOD_RECURSIVE);
  for (int a = 0; a < model[0].n; a++) {
    const double bend = modes.kind[a] == FB_KIND_BEND_Y ? 0.02 : 0.015;
    start[0].q[a] = (fb_real)(modes.kind[a] == FB_KIND_AXIAL ? 0.0 : bend / n_element);
  }
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
  for (int step = 0; step < 100; step++) { /* until the stretch that does not fit the slopes has died out */
    FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, NULL, NULL, FB_R(0.002), 20), FB_OK);
  }
  for (int k = 0; k < 3; k++) {
    end[k] = state;
    memset(&work, 0xff, sizeof work); /* it means nothing between calls */
    FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &end[k], &work, NULL, NULL, FB_R(0.002), iterations[k]), FB_OK);
  }
  for (int k = 0; k < 2; k++) {
    left[k] = fbt_difference(end[k].link[0].q, end[2].link[0].q, model[0].n);
  }
}

/* E11.13, E8.29: Newton's iterations of a step with the tangent of the nonlinear strain, bent in both planes or one: the second
   leaves less than a two hundredth, a fiftieth of what the first leaves; where that tangent is in the matrix alone it was a
   sixth. */
TEST(strained_bodies_converge_in_a_system)
{
  for (int run = 0; run < 3; run++) {
    double left[2];
    strained_left(left, run ? 4 : 1, run != 2, run != 1);
    FBT_TRUE(left[0] > 1e-8);
    FBT_BELOW(left[1], (run ? 0.02 : 0.005) * left[0]);
  }
  close_loop(FB_JOINT_SPHERICAL, FB_GROUND, 0, 0, 0); /* and it is held by a loop, from aside, in a work of anything */
  start[0].value[0] = FB_R(0.3);
  init(FB_METHOD_RECURSIVE);
  memset(&work, 0xff, sizeof work);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
  FBT_NEAR_ABS(state.link[0].x[0], 0.0, FBT_TOL(1e-12, 1e-5));
}

/* E11.13, E11.14: a double pendulum whose elbow is a spring of a thousand periods a step swings as the rigid one, with
   rk4 refused; a damped stiff joint, too. */
TEST(stiff_joints_take_long_steps)
{
  for (int run = 0; run < 2; run++) {
    const double dt = 0.005;
    fb_system_state whole;
    fresh();
    body_desc.effects = FB_EFFECT_GRAVITY;
    body_desc.gravity[1] = -FB_R(9.81);
    rigid(&model[0], 1.0, 0, -0.5, 0, 1.0 / 12.0, 0, 1.0 / 12.0);
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    hang(1, 0, FB_JOINT_REVOLUTE, 0, 1);
    desc.joint[1].mode[0] = FB_AXIS_LOCKED;
    start[0].value[0] = FB_R(0.8);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &whole, start, NULL), FB_OK);
    for (int step = 0; step < 4000; step++) {
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &whole, &work, NULL, NULL, NULL, FB_R(0.0005)), FB_OK);
    }
    desc.joint[1].mode[0] = FB_AXIS_FREE;
    desc.joint[1].stiffness[0] = (fb_real)FBT_TOL(1e10, 1e6);
    desc.joint[1].damping[0] = run ? FB_R(1e4) : 0;
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, (fb_real)dt), FB_ERR_STEP);
    for (int step = 0; step < 400; step++) {
      FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, NULL, NULL, (fb_real)dt, 0), FB_OK);
    }
    FBT_NEAR_ABS(state.link[0].x[0], whole.link[0].x[0], FBT_TOL(1e-3, 2e-3));
    FBT_BELOW(fabs((double)state.link[1].x[0]), FBT_TOL(1e-6, 1e-4));
  }
}

/* E9.13, E9.15, E11.12: a chain of six flexible bodies in free flight, driven by its motors: total momenta stay, energy
   changes by the motors' work. The same over 1e6 steps is make check-long. */
TEST(a_chain_in_free_flight_keeps_its_momenta)
{
  fb_momentum before, after;
  double energy;
  const int steps = 2000;
  fresh();
  flexible(&model[0], 2, 1, 1, FB_EFFECTS_FULL);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  for (int k = 1; k < 6; k++) {
    hang(k, 0, k % 2 ? FB_JOINT_REVOLUTE : FB_JOINT_UNIVERSAL, k - 1, 1);
    desc.joint[k].stiffness[0] = desc.joint[k].stiffness[1] = FB_R(2.0);
    start[k].value[0] = FB_R(0.3);
    start[k].speed[0] = FB_R(0.1);
  }
  start[0].speed[4] = FB_R(0.2);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_momentum(&mechanism, model, &work, &before, &state, &input), FB_OK);
  energy = energy_of(&state);
  for (int step = 0; step < steps; step++) {
    for (int k = 1; k < 6; k++) {
      input.drive[k].torque[0] = (fb_real)(0.02 * sin(0.004 * step * k));
    }
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(5e-4)), FB_OK);
  }
  FBT_INT_EQ(fb_system_momentum(&mechanism, model, &work, &after, &state, &input), FB_OK);
  FBT_BELOW(fbt_difference(after.linear, before.linear, 3), FBT_TOL(1e-12, 1e-4));
  FBT_BELOW(fbt_difference(after.angular, before.angular, 3), FBT_TOL(1e-12, 1e-3));
  FBT_NEAR_ABS(energy_of(&state) - energy, state.motor_work, FBT_TOL(1e-8, 1e-3));
}

/* E9.7, E9.8: kept angles go round: a hinge and the second axis of a universal joint driven through half a turn
   and a screw started far out, kept as constraints, are where the tree has them. */
TEST(kept_joints_turn_all_the_way_round)
{
  fb_system_input middle;
  for (int method = 0; method < 3; method += 2) {
    fresh();
    rigid(&model[0], 1.0, 0.2, 0, 0, 0.1, 0.1, 0.1);
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    desc.joint[0].mode[0] = FB_AXIS_PRESCRIBED;
    hang(1, 0, FB_JOINT_SCREW, FB_GROUND, 0);
    desc.joint[1].pitch = FB_R(0.1);
    hang(2, 0, FB_JOINT_UNIVERSAL, FB_GROUND, 0);
    desc.joint[2].mode[0] = FB_AXIS_LOCKED;
    desc.joint[2].mode[1] = FB_AXIS_PRESCRIBED;
    start[1].value[0] = FB_R(2.5);
    start[1].speed[0] = FB_R(2.0);
    input.drive[0].value[0] = input.drive[2].value[1] = FB_R(2.5);
    input.drive[0].rate[0] = input.drive[2].rate[1] = FB_R(2.0);
    init((fb_method)method);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    middle = input;
    for (int k = 1; k <= 800; k++) { /* to 4.1 rad */
      middle.drive[0].value[0] = middle.drive[2].value[1] = (fb_real)(2.5 + 0.002 * (k - 0.5));
      input.drive[0].value[0] = input.drive[2].value[1] = (fb_real)(2.5 + 0.002 * k);
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &middle, &input, FB_R(0.001)), FB_OK);
    }
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    FBT_NEAR_ABS(remainder((double)motion.joint[0].value[0] - 4.1, 2.0 * pi), 0.0, FBT_TOL(1e-9, 1e-4));
    FBT_NEAR_ABS(remainder((double)motion.joint[2].value[1] - 4.1, 2.0 * pi), 0.0, FBT_TOL(1e-9, 1e-4));
    FBT_NEAR_ABS(motion.pose[1].rho[2], 0.41, FBT_TOL(1e-9, 1e-4));
  }
}

/* E9.4: a body that moves no inertia along an axis is refused with its joint where the axis may move, and taken where
   it is locked: its limit is then that of the others. */
TEST(locked_axes_need_no_inertia)
{
  for (int locked = 0; locked < 4; locked++) { /* turn, slide of a cylindrical joint */
    fresh();
    rigid(&model[0], 1.0, 0, 0, 0, 0.5, 0.5, 0.5);
    rigid(&model[1], 0, 0, 0, 0, 0, 0, 0);
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    hang(1, 1, FB_JOINT_CYLINDRICAL, 0, 0);
    desc.joint[0].stiffness[0] = FB_R(200.0);
    for (int i = 0; i < 2; i++) {
      desc.joint[1].mode[i] = locked >> i & 1 ? FB_AXIS_LOCKED : FB_AXIS_FREE;
    }
    FBT_INT_EQ(fb_system_init(&mechanism, &work, model, 2, &desc), locked == 3 ? FB_OK : FB_ERR_SINGULAR);
    if (locked == 3) {
      FBT_NEAR_REL(fb_system_rk4_limit(&mechanism, model, 0, 0), 2.785 / sqrt(1.05 * 200.0 / 0.5), FBT_TOL(1e-9, 1e-4));
    } else {
      FBT_INT_EQ(work.joint, 1);
    }
  }
}

/* E9.4: whether an axis moves inertia is a matter of proportion: two hinges of micrograms and micrometers, swing as
   k (1/J_0 + 1/J_1) has it. */
TEST(specks_swing_as_large_bodies_do)
{
  const double J0 = 0.2, J1 = 0.3, k = 5.0;
  kilogram = 1e-9;
  meter = 1e-6;
  fresh();
  rigid(&model[0], 1.0, 0, 0, 0, 1, 1, J0);
  rigid(&model[1], 2.0, 0, 0, 0, 1, 1, J1);
  for (int j = 0; j < 2; j++) {
    hang(j, j, FB_JOINT_REVOLUTE, j - 1, 0);
  }
  desc.joint[1].stiffness[0] = (fb_real)(k * kilogram * meter * meter);
  init(FB_METHOD_RECURSIVE);
  FBT_NEAR_REL(fb_system_rk4_limit(&mechanism, model, 0, 0), 2.785 / sqrt(1.05 * k * (1.0 / J0 + 1.0 / J1)),
               FBT_TOL(1e-9, 1e-4));
  kilogram = meter = 1.0;
}

/* E9.4, E9.5: a body without mass between two joints of a kind, the ground or nothing on one side of it, a body on the
   other: their axes are the same ones, of a ball joint all of them, and it is refused, whichever way its axes are, what
   is left of the inertia being rounding. Where the axes differ it is carried along. */
TEST(what_moves_no_inertia_but_rounding_is_refused)
{
  static const fb_joint_kind kinds[3] = {FB_JOINT_PRISMATIC, FB_JOINT_REVOLUTE, FB_JOINT_SPHERICAL};
  fbt_seed(31);
  for (int run = 0; run < 240; run++) {
    const int kind = run % 3, axis = run / 3 % 3, held = run / 9 % 2, aside = run / 18 % 4 == 0 && held && kind < 2;
    const double angle = 2.0 * pi / 3.0 * (axis - 1) / sqrt(3.0), offset = run % 2 ? 1e3 : 0.0;
    fresh();
    rigid(&model[0], 0, 0, 0, 0, 0, 0, 0);
    rigid(&model[1], 2.0, 0, 0, 0, 10.0, 10.0, 10.0);
    for (int k = 0; k < 2; k++) {
      hang(k, k, k == 1 || held ? kinds[kind] : FB_JOINT_FREE, k - 1, 0);
    }
    turn(desc.joint[0].child_attitude, angle, angle, angle); /* z of the joint is x, y or z of the body */
    turn(desc.joint[1].attitude, angle + 0.4 * aside, angle, angle);
    turn_anyhow(desc.joint[1].child_attitude, 2.0);
    for (int i = 0; i < 3; i++) {
      (kind ? desc.joint[1].child_position : desc.joint[1].position)[i] = (fb_real)(offset * fbt_random());
    }
    FBT_INT_EQ(fb_system_init(&mechanism, &work, model, 2, &desc), aside ? FB_OK : FB_ERR_SINGULAR);
    FBT_INT_EQ(work.joint, aside ? -1 : 0);
  }
}

/* E9.4: a load of ten thousand links on a chain of eight, each turned by 0.1, begins to fall as its equations have it:
   what a hinge moves is its link alone, a millionth of what hangs on it and no rounding. */
TEST(heavy_loads_hang_on_light_chains)
{
  const int n = 8;
  const double load = 1e4;
  double x[16] = {0}, dx[16];
  fresh();
  body_desc.effects = FB_EFFECT_GRAVITY;
  body_desc.gravity[1] = -FB_R(9.81);
  rigid(&model[0], 1.0, 0, -0.5, 0, 1.0 / 12.0, 0, 1.0 / 12.0);
  rigid(&model[1], load, 0, -0.5, 0, load / 12.0, 0, load / 12.0);
  for (int k = 0; k < n; k++) {
    hang(k, k == n - 1, FB_JOINT_REVOLUTE, k - 1, k > 0);
    start[k].value[0] = FB_R(0.1);
    x[k] = 0.1 * (k + 1);
  }
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
  pendulum_rates(dx, x, n, load);
  for (int k = 0; k < n; k++) {
    const double exact = dx[n + k] - (k > 0 ? dx[n + k - 1] : 0.0);
    FBT_NEAR_ABS(motion.joint[k].acceleration[0], exact, FBT_TOL(1e-7, 0.1)); /* of up to 30 rad/s^2 */
  }
}

/* E11.12: springs and dampers of kept joints, each against what its axis moves: a ball joint at the mass center
   k (1/J_1 + 1/J_2 + 1/J_3), a cylindrical one k_0/J_3 + k_1 (1/m + r^2/J), its axis r beside the center. */
TEST(limits_of_kept_joints_are_in_closed_form)
{
  const double m = 2.0, r = 0.4, J[3] = {0.3, 0.5, 0.7}, k[2] = {90.0, 50.0}, c[2] = {2.0, 3.0};
  for (int ball = 0; ball < 2; ball++) {
    const double sum[2] = {ball ? 1.0 / J[0] + 1.0 / J[1] + 1.0 / J[2] : 1.0 / J[2],
                           ball ? 0.0 : 1.0 / m + r * r / J[1]};
    const double g = 0.5 * (c[0] * sum[0] + c[1] * sum[1]), stiff = k[0] * sum[0] + k[1] * sum[1];
    fresh();
    rigid(&model[0], m, 0, 0, 0, J[0], J[1], J[2]);
    hang(0, 0, ball ? FB_JOINT_SPHERICAL : FB_JOINT_CYLINDRICAL, FB_GROUND, 0);
    desc.joint[0].child_position[0] = ball ? FB_R(0.0) : (fb_real)r;
    for (int i = 0; i < 2; i++) {
      desc.joint[0].stiffness[i] = (fb_real)k[i];
      desc.joint[0].damping[i] = (fb_real)c[i];
    }
    init(FB_METHOD_MULTIPLIERS);
    FBT_NEAR_REL(fb_system_rk4_limit(&mechanism, model, 0, 0), 2.785 / (g + sqrt(g * g + stiff)), FBT_TOL(1e-9, 1e-4));
  }
}

/* E9.19: the reactions on a body are what its joints bear, about its origin in its axes: the own one's, and the
   opposite of those that hang on it; gravity lifts the energy of all by m g h. */
TEST(reactions_are_the_sum_of_joint_forces)
{
  const double g = 9.81;
  for (int method = 0; method < 3; method++) {
    fb_energy energy;
    double height = 0.0;
    couple(FB_JOINT_UNIVERSAL, 1, FB_AXIS_PRESCRIBED);
    body_desc.gravity[2] = -(fb_real)g;
    flexible(&model[0], 1, 1, 1, FB_EFFECTS_FULL | FB_EFFECT_GRAVITY);
    init((fb_method)method);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    for (int k = 0; k < 2; k++) {
      const fb_joint_motion *at = &motion.joint[1];
      fb_real R[9], frame[3], arm[3], moment[3], force[3], torque[3];
      fb_quat_to_mat33(R, motion.pose[1].quat);
      fb_mat33_mul_vec3(frame, R, desc.joint[1].child_position);
      for (int i = 0; i < 3; i++) {
        arm[i] = motion.pose[1].rho[i] + frame[i] - motion.pose[k].rho[i];
      }
      fb_vec3_cross(moment, arm, at->force);
      for (int i = 0; i < 3; i++) {
        moment[i] += at->torque[i];
      }
      fb_quat_to_mat33(R, motion.pose[k].quat);
      fb_mat33_mulT_vec3(force, R, at->force);
      fb_mat33_mulT_vec3(torque, R, moment);
      for (int i = 0; i < 3; i++) {
        const double sign = k == 0 ? -1.0 : 1.0;
        FBT_NEAR_ABS(motion.motion[k].reaction_force[i], sign * (double)force[i], FBT_TOL(1e-11, 1e-3));
        FBT_NEAR_ABS(motion.motion[k].reaction_torque[i], sign * (double)torque[i], FBT_TOL(1e-11, 1e-3));
      }
    }
    for (int k = 0; k < 2; k++) { /* undeformed the mass center is where the shape has it */
      fbt_fill(start[k].q, model[0].n, 0.0);
    }
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    FBT_INT_EQ(fb_system_energy(&mechanism, model, &work, &energy, &state, &input), FB_OK);
    for (int k = 0; k < 2; k++) {
      fb_real R[9], center[3];
      fb_quat_to_mat33(R, motion.pose[k].quat);
      fb_mat33_mul_vec3(center, R, shape.c);
      height += (double)(shape.mass * motion.pose[k].rho[2] + center[2]);
    }
    FBT_NEAR_ABS(energy.gravity, g * height, FBT_TOL(1e-12, 1e-4));
  }
}

/* What was found in review: work that holds anything, loops torn open, half a turn off, springs of loops in the limits,
   prescribed axes from the start, many rows, small attitudes, power of what is prescribed. */
static int many_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  const int n = *(const int *)user;
  (void)pose, (void)t;
  for (int k = 0; k < n && k < capacity; k++) { /* the same one over and over */
    row[k].body[1] = FB_GROUND;
    row[k].force[0][0] = FB_R(1.0);
  }
  return n < capacity ? n : capacity;
}

TEST(systems_refuse_what_is_not_right)
{
  int many = 30;
  fb_real limit;
  tree(FB_EFFECTS_FULL, 0); /* the work means nothing between calls */
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
  kept = state;
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &kept, &work, &input, &input, &input, FB_R(2e-4)), FB_OK);
  memset(&work, 0xff, sizeof work);
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(2e-4)), FB_OK);
  FBT_TRUE(memcmp(&kept, &state, sizeof state) == 0);
  memset(&work, 0xff, sizeof work);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
  memset(&work, 0xff, sizeof work);
  FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, FB_R(2e-4), 0), FB_OK);
  fourbar(0.4, 1.0, 0.8, 1.1, FB_JOINT_REVOLUTE); /* the rocker's value jumps: the loop cannot follow */
  desc.joint[0].mode[0] = desc.joint[2].mode[0] = FB_AXIS_PRESCRIBED;
  input.drive[0].value[0] = FB_R(0.7);
  input.drive[2].value[0] = (fb_real)rocker_angle(0.4, 1.0, 0.8, 1.1, 0.7);
  start[1].value[0] = -FB_R(0.3);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
  input.drive[2].value[0] += FB_R(0.02);
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(1e-3)),
             FB_ERR_CONTRADICTION);
  FBT_INT_EQ(work.joint, 3);
  fresh(); /* a hinge closed upside down */
  rigid(&model[0], 1.0, 0.2, 0, 0, 0.1, 0.1, 0.1);
  hang(0, 0, FB_JOINT_SPHERICAL, FB_GROUND, 0);
  close_loop(FB_JOINT_REVOLUTE, FB_GROUND, 0, 0, 0);
  turn(start[0].quat, 3.0, 0, 0);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_ERR_CONTRADICTION);
  FBT_INT_EQ(work.joint, 1);
  desc.loop[0].stiffness[0] =
      FB_R(400.0); /* and its spring in the limit: sqrt(400/(0.1 + 0.04)), 5 % more of the tree's */
  init(FB_METHOD_RECURSIVE);
  limit = fb_system_rk4_limit(&mechanism, model, 0, 0);
  FBT_NEAR_REL(limit, 2.785 / sqrt(400.0 / 0.14), FBT_TOL(1e-9, 1e-4));
  turn(start[0].quat, 0, 0, 0.1);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, NULL), FB_OK);
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, FB_R(1.01) * limit), FB_ERR_STEP);
  FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, NULL, NULL, FB_R(1.01) * limit, 0), FB_ERR_STEP);
  fresh(); /* prescribed from the start: the other joint's speed stays what it was asked to be */
  rigid(&model[0], 1.0, 0, -0.5, 0, 0.1, 0.1, 0.1);
  hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
  hang(1, 0, FB_JOINT_REVOLUTE, 0, 1);
  desc.joint[0].mode[0] = FB_AXIS_PRESCRIBED;
  input.drive[0].value[0] = FB_R(1.0);
  input.drive[0].rate[0] = FB_R(2.0);
  start[1].value[0] = FB_R(0.5);
  start[1].speed[0] = FB_R(0.25);
  for (int method = 0; method < 3; method++) {
    init((fb_method)method);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    FBT_NEAR_ABS(motion.joint[1].speed[0], 0.25, FBT_TOL(1e-12, 1e-5));
    FBT_NEAR_ABS(motion.joint[1].value[0], 0.5, FBT_TOL(1e-12, 1e-5));
  }
  fresh(); /* many rows, more than half of what there is room for; a body dragged along; its power */
  rigid(&model[0], 2.0, 0, 0, 0, 0.1, 0.1, 0.1);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  input.rows = many_rows;
  input.user = &many;
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, NULL, &input), FB_OK);
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(1e-3)), FB_OK);
  FBT_INT_EQ(work.rank, 1);
  many = -7;
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(1e-3)), -7);
  fresh();
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  desc.joint[0].mode[0] = FB_AXIS_PRESCRIBED;
  input.drive[0].rate[0] = FB_R(3.0);
  input.drive[0].acceleration[0] = FB_R(5.0);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, NULL, &input), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
  FBT_NEAR_ABS(motion.power, 2.0 * 5.0 * 3.0, FBT_TOL(1e-12, 1e-4));
  fresh(); /* an attitude of a hundred-millionth of a turn is one */
  hang(0, 0, FB_JOINT_RIGID, FB_GROUND, 0);
  turn(desc.joint[0].child_attitude, 1e-9, 0, 0);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &work, &state, NULL, NULL), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
  FBT_NEAR_ABS(motion.pose[0].quat[1], -0.5e-9, 1e-13);
}

/* Quick ones first: most of what goes wrong shows in no time. */
SUITE(system, RUN(free_bodies_without_mass_are_refused_in_every_attitude),
      RUN(accelerations_are_the_rates_of_velocities), RUN(systems_keep_energy_and_momentum),
      RUN(inputs_are_linear_between_the_ends_of_a_step), RUN(constraints_are_asked_for_within_the_step),
      RUN(springs_of_loops_pull_like_those_of_the_tree), RUN(a_prescribed_loop_closes_where_it_is_told),
      RUN(a_locked_loop_closes_where_the_free_one_does), RUN(systems_that_memory_has_changed_are_refused),
      RUN(states_out_of_range_are_refused), RUN(loops_are_closed_the_right_way_round),
      RUN(a_bead_is_flung_along_a_turning_wire), RUN(rows_along_which_nothing_moves_are_left_out),
      RUN(rows_are_weighed_with_their_kind), RUN(what_a_loop_misses_is_relative),
      RUN(the_limit_finds_neighbors_against_each_other), RUN(what_is_prescribed_has_no_limit),
      RUN(a_knife_edge_draws_a_cycloid), RUN(contradictions_name_their_joint), RUN(wrong_rows_are_named),
      RUN(momenta_give_back_the_speeds), RUN(springs_and_dampers_balance_energy),
      RUN(joint_forces_carry_what_hangs_on_them), RUN(locked_axes_need_no_inertia),
      RUN(linkages_swing_alike_in_any_unit_of_length), RUN(loops_slide_any_way),
      RUN(a_locked_ball_holds_where_it_closes), RUN(a_loop_closes_the_shortest_way),
      RUN(methods_agree_on_as_many_modes_as_there_can_be), RUN(force_and_torque_are_weighed_apart),
      RUN(what_moves_no_inertia_but_rounding_is_refused), RUN(heavy_loads_hang_on_light_chains),
      RUN(limits_of_kept_joints_are_in_closed_form), RUN(reactions_are_the_sum_of_joint_forces),
      RUN(systems_refuse_what_is_not_right), RUN(every_joint_moves_as_it_should),
      RUN(joint_frames_may_be_half_a_turn_off), RUN(a_node_that_only_turns_carries_its_body),
      RUN(system_steps_beyond_the_limit_are_refused), RUN(the_limit_of_a_linkage_is_in_closed_form),
      RUN(a_stretching_rod_carries_its_neighbor), RUN(attitudes_come_back_as_they_were),
      RUN(a_dense_matrix_may_be_full), RUN(free_bodies_have_no_parent),
      RUN(nodes_that_move_in_one_way_carry_their_bodies), RUN(a_ball_joint_has_one_spring_and_one_damper),
      RUN(an_imu_reads_in_its_own_axes), RUN(screws_without_pitch_are_hinges), RUN(locked_free_bodies_stand),
      RUN(work_means_nothing_between_calls), RUN(specks_swing_as_large_bodies_do), RUN(every_mode_is_within_its_range),
      RUN(given_axes_have_no_momentum_rates), RUN(rows_may_disagree_by_a_hundredth), RUN(stiff_joints_take_long_steps),
      RUN(a_loop_that_closes_keeps_shape_and_momentum), RUN(one_iteration_is_enough_for_a_linear_system),
      RUN(the_limit_finds_the_fastest_body), RUN(no_input_is_an_input_of_zeros),
      RUN(strained_bodies_converge_in_a_system), RUN(a_chain_in_free_flight_keeps_its_momenta),
      RUN(one_iteration_is_enough_about_a_stretched_beam), RUN(systems_know_no_units),
      RUN(systems_converge_with_the_order_of_the_scheme), RUN(a_latch_conserves_momentum),
      RUN(steps_that_have_not_converged_say_so), RUN(a_fast_sled_does_not_hide_what_bends),
      RUN(steps_that_turn_too_far_are_refused), RUN(thin_tubes_keep_calm), RUN(flight_speed_changes_nothing),
      RUN(driven_roots_fly_as_they_stand), RUN(fast_systems_keep_their_angular_momentum),
      RUN(every_set_keeps_the_momenta_of_free_systems), RUN(systems_lose_nothing_by_short_steps),
      RUN(kept_joints_turn_all_the_way_round), RUN(a_full_system_balances_its_energy),
      RUN(every_joint_is_the_same_eliminated_kept_or_closing_a_loop), RUN(the_three_methods_agree),
      RUN(the_check_word_of_a_system_sees_every_byte), RUN(tops_follow_the_references),
      RUN(pendulums_of_rods_follow_their_equations), RUN(gimbal_has_the_published_eigenvalues),
      RUN(redundant_loops_are_accepted), RUN(flexible_double_pendulum_follows_the_reference),
      RUN(slider_crank_follows_the_reference), RUN(a_parallelogram_passes_its_flat_positions),
      RUN(a_disc_rolls_steadily), RUN(a_cut_beam_behaves_as_the_whole))
