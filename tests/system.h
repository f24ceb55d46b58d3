/* system.h - bodies, joints and trees of them, shared by the tests of >>system: joints, trees, loops: the
   same motion by joints that are eliminated and by joints that close loops, conservation, closed forms and references of rigid and flexible
   mechanisms. */
#ifndef FBT_SYSTEM_H
#define FBT_SYSTEM_H

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
static fb_system_state state;
static fb_system_input input;
static fb_system_motion motion;
static fb_link_motion start[FB_MAX_BODIES];
static double kilogram = 1.0, meter = 1.0, second = 1.0; /* what bodies are measured in */

/* A kind of joint as the header has it: its axes; the numbers of that which is an angle about z, a slide along z, an
   angle about the turned x; -1: none. The angle of a screw slides, too. */
typedef struct joint_axes {
  int count, angle, slide, tilt;
} joint_axes;

static const joint_axes joint_axes_by_kind[] = {{6, -1, -1, -1}, {0, -1, -1, -1}, {1, 0, -1, -1}, {1, -1, 0, -1},
                                                {2, 0, 1, -1},   {1, 0, -1, -1},  {2, 0, -1, 1},  {3, -1, -1, -1}};
FBT_ONE_EACH(joint_axes_by_kind, FB_JOINT_COUNT);

static inline const joint_axes *axes_of(int kind)
{
  return &joint_axes_by_kind[kind];
}

/* How a test has the joints of its description: eliminated, by either method (an fb_method), or as loops, all bodies
   being free. joint_at: number of the joint that body k has in the description. */
enum { AS_LOOPS = FB_METHOD_COUNT, FORMS };
static int joint_at[FB_MAX_BODIES];

static inline fb_joint_desc *joint_of(int k)
{
  return joint_at[k] < desc.n_body ? &desc.joint[joint_at[k]] : &desc.loop[joint_at[k] - desc.n_body];
}

/* Motion at a state; what joints do by the numbers of the description. */
static inline void motion_of(fb_system_motion *out, const fb_system_state *s)
{
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, out, s, &input), FB_OK);
  for (int k = 0; k < desc.n_body; k++) {
    out->joint[k] = out->joint[joint_at[k]];
  }
}

static inline void fresh(void)
{
  for (int k = 0; k < FB_MAX_BODIES; k++) {
    joint_at[k] = k;
  }
  memset(&desc, 0, sizeof desc);
  memset(&input, 0, sizeof input);
  memset(start, 0, sizeof start);
  memset(&body_desc, 0, sizeof body_desc);
  memset(&beam_desc, 0, sizeof beam_desc);
}

/* A rigid body about its origin. */
static inline void rigid(fb_body *body, double mass, double cx, double cy, double cz, double jx, double jy, double jz)
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
static inline void flexible(fb_body *body, int y, int z, int t, unsigned effects)
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
  d.deflection_limit = effects & FB_EFFECT_LARGE_DEFLECTION ? FB_R(0.0) : (fb_real)meter; /* lines have their own */
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)(0.5 * kilogram), root, inertia),
             FB_OK); /* a clamped beam alone has none to move freely */
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, (fb_real)meter), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, (fb_real)(0.5 * meter)), FB_OK);
  fbt_fit(&d);
  FBT_INT_EQ(fb_body_init(body, &body_work, &shape, &d), FB_OK);
}

static inline void hang(int k, int body, fb_joint_kind kind, int parent, int node)
{
  fb_joint_desc *j = &desc.joint[k];
  desc.n_body = k + 1 > desc.n_body ? k + 1 : desc.n_body;
  desc.model[k] = body;
  j->kind = kind;
  j->parent = parent;
  j->parent_node = node;
}

static inline void turn(fb_real quat[4], double x, double y, double z)
{
  const fb_real phi[3] = {(fb_real)x, (fb_real)y, (fb_real)z};
  fb_quat_from_rotvec(quat, phi);
}

/* Each component up to size; one after the other, arguments have no order. */
static inline void turn_anyhow(fb_real quat[4], double size)
{
  double phi[3];
  for (int i = 0; i < 3; i++) {
    phi[i] = size * fbt_random();
  }
  turn(quat, phi[0], phi[1], phi[2]);
}

/* Bodies from number `from` on are free where the tree has them at the start, their joints close loops; existing loops
   keep their numbers. */
static inline void joints_to_loops(int from)
{
  static fb_system_state there;
  static fb_system_motion at;
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &there, &work, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &at, &there, &input), FB_OK);
  for (int k = from; k < desc.n_body; k++) {
    if (desc.joint[k].kind != FB_JOINT_FREE) {
      fb_joint_desc *const loop = &desc.loop[desc.n_loop];
      FBT_TRUE(desc.n_loop < FB_MAX_LOOPS);
      joint_at[k] = desc.n_body + desc.n_loop++;
      *loop = desc.joint[k];
      loop->child = k;
      memset(&desc.joint[k], 0, sizeof desc.joint[k]);
      input.drive[joint_at[k]] = input.drive[k];
      memset(&input.drive[k], 0, sizeof input.drive[k]);
    }
    memcpy(start[k].value, at.pose[k].rho, sizeof start[k].value);
    memcpy(start[k].quat, at.pose[k].quat, sizeof start[k].quat);
    memcpy(start[k].q, at.pose[k].q, sizeof start[k].q);
    memcpy(start[k].speed, at.motion[k].v, sizeof at.motion[k].v);
    memcpy(start[k].speed + 3, at.motion[k].w, sizeof at.motion[k].w);
    memcpy(start[k].q_dot, at.motion[k].q_dot, sizeof start[k].q_dot);
  }
}

static inline void init(int form)
{
  for (int pass = 0; pass < (form == AS_LOOPS ? 2 : 1); pass++) {
    if (pass) {
      joints_to_loops(0);
    }
    desc.method = form == FB_METHOD_DENSE ? FB_METHOD_DENSE : FB_METHOD_RECURSIVE;
    FBT_INT_EQ(fb_system_init(&mechanism, &work, model, &desc, fbt_models(&desc)), FB_OK);
    FBT_INT_EQ(fb_system_check(&mechanism, model, FB_MAX_BODIES), FB_OK);
  }
}

/* A tree with every kind of joint: free hub, flexible links, offsets and turned axes on both sides, springs and
   dampers; in motion. */
static inline void tree(unsigned effects, int damped)
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

static inline double energy_of(const fb_system_state *s)
{
  fb_energy e;
  FBT_INT_EQ(fb_system_energy_eval(&mechanism, model, &work, &e, s, &input), FB_OK);
  return (double)(e.kinetic + e.strain + e.gravity);
}

/* state + h rate, coordinate by coordinate */
static inline void moved(fb_system_state *out, const fb_system_state *s, const fb_system_state *r, double h)
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

/* Largest difference of poses, velocities and accelerations of all bodies, and of joint forces. */
static inline double motion_difference(const fb_system_motion *a, const fb_system_motion *b)
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

/* A torque where the joint has a motor, else zero. */
static inline fb_real motor_of(int joint, int axis, double torque)
{
  const fb_joint_kind kind = desc.joint[joint].kind;
  return kind != FB_JOINT_FREE && axis < axes_of((int)kind)->count ? (fb_real)torque : FB_R(0.0);
}

/* Motors, loads on nodes in all axes, some axes locked, some prescribed. */
static inline void drives(void)
{
  for (int k = 1; k < desc.n_body; k++) {
    for (int i = 0; i < 3; i++) {
      input.drive[k].torque[i] = motor_of(k, i, 0.3 * fbt_random());
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

static inline void stepped(fb_system_state *s, int n, double dt)
{
  fb_system_input middle = input, end = input, first = input;
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, s, &work, start, &input), FB_OK);
  for (int step = 0; step < n; step++) {
    const double t[3] = {dt * step, dt * (step + 0.5), dt * (step + 1)};
    fb_system_input *at[3];
    at[0] = &input;
    at[1] = &middle;
    at[2] = &end;
    for (int i = 0; i < 3; i++) {
      for (int k = 1; k < 3; k++) {
        fb_drive *d = &at[i]->drive[joint_at[k]];
        const double a = 0.5 * k / (second * second);
        const fb_drive *from = &first.drive[joint_at[k]];
        d->value[k - 1] = from->value[k - 1] + (fb_real)t[i] * from->rate[k - 1] + (fb_real)(0.5 * a * t[i] * t[i]);
        d->rate[k - 1] = from->rate[k - 1] + (fb_real)(a * t[i]);
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

/* Rates of the planar pendulum of n uniform rods, the last of mass `last`, the others of 1 kg, from its mass matrix by
   elimination: angles from the vertical. */
static inline void pendulum_rates(double *dx, const double *x, int n, double last)
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

/* A joint that closes a loop. */
static inline fb_joint_desc *close_loop(fb_joint_kind kind, int parent, int parent_node, int child, int child_node)
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
static inline void fourbar(double a, double b, double c, double d, fb_joint_kind closing)
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
static inline double rocker_angle(double a, double b, double c, double d, double crank)
{
  const double x = a * cos(crank) - d, y = a * sin(crank), r2 = x * x + y * y, r = sqrt(r2);
  const double cosine = (r2 + c * c - b * b) / (2.0 * r * c);
  return atan2(y, x) - acos(cosine);
}

/* A body on a joint of that kind at the tip of another, both bend: turned frames, springs, dampers, motors, a load, in
   motion; one axis may be given. */
static inline void couple(fb_joint_kind kind, int axis, fb_axis_mode mode)
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
    input.drive[1].torque[i] = motor_of(1, i, fbt_random());
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
static inline void couple_by_a_loop(const fb_system_motion *at, int backwards)
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
    input.drive[1].torque[i] = FB_R(0.0);
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
static inline fb_system_input driven(double t)
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

static inline void couple_steps(int n, double dt)
{
  for (int step = 0; step < n; step++) {
    const fb_system_input middle = driven(0.5 * dt), end = driven(dt);
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &middle, &end, (fb_real)dt), FB_OK);
    input = end;
  }
}

/* A flexible beam of p11's kind: length, mass per length, EI in the plane; z is out of the plane. */
static inline void link_beam(fb_body *body, double length, double mass, double EI, double EA, int bending, int axial,
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
static inline void node_at(double x[3], const fb_system_state *s, int body, int node)
{
  fb_node_motion at;
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, s, &input), FB_OK);
  FBT_INT_EQ(fb_body_node_motion_eval(&model[desc.model[body]], &at, &motion.pose[body], &motion.motion[body], node),
             FB_OK);
  for (int i = 0; i < 3; i++) {
    x[i] = (double)at.position[i];
  }
}

/* The reactions on bodies 0 and 1 are what joint j between them bears, about their origins in their axes. */
static inline void reactions_are_of_joint(int j, double tol)
{
  const fb_joint_motion *const at = &motion.joint[j];
  for (int k = 0; k < 2; k++) {
    const double sign = k == 0 ? -1.0 : 1.0;
    fb_real R[9], frame[3], arm[3], moment[3], force[3], torque[3];
    fb_quat_to_mat33(R, motion.pose[1].quat);
    fb_mat33_mul_vec3(frame, R, joint_of(j)->child_position);
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
      FBT_NEAR_ABS(motion.motion[k].reaction_force[i], sign * (double)force[i], tol);
      FBT_NEAR_ABS(motion.motion[k].reaction_torque[i], sign * (double)torque[i], tol);
    }
  }
}

#endif
