/* >>exact: joints within an exact beam: chains of rods and of elastic links against bodies of a system, references of
   another program, closed forms, and what must be constant. */
#include "exact.h"

static const double stiff[6] = {0.0, 0.0, 0.0, 2e4, 3e4, 2.5e4}, slim[6] = {0.8, 0.8, 0.8, 3e-3, 1e-3, 2e-3};

/* Hinge at an element, about an axis of any length. */
static fb_exact_joint *hinge(int element, double x, double y, double z)
{
  fb_exact_joint *const joint = &desc.joint[desc.n_joint++];
  joint->element = element;
  joint->axis[0] = (fb_real)x;
  joint->axis[1] = (fb_real)y;
  joint->axis[2] = (fb_real)z;
  return joint;
}

static fb_exact_hinge joint_of(int k)
{
  fb_exact_hinge out;
  FBT_INT_EQ(fb_exact_joint_eval(&exact, &out, &state, k), FB_OK);
  return out;
}

/* Two elastic links on hinges with springs about skew axes, a hub on the node between; clamped base. */
static void elbow(int n)
{
  const double stiffness[6] = {1e5, 4e4, 4e4, 80.0, 100.0, 150.0};
  fb_exact_joint *joint;
  beam(2.0, 2 * n + 2, stiffness, slim);
  desc.iterations = 12;
  joint = hinge(0, 0.0, 1.0, 0.3);
  joint->angle = FB_R(0.3);
  joint->stiffness = FB_R(5.0);
  joint->rest = FB_R(-0.7);
  joint = hinge(n + 1, 0.2, 0.5, 1.0);
  joint->angle = FB_R(1.0);
  joint->rate = FB_R(2.0);
  joint->stiffness = FB_R(2.0);
  desc.n_lump = 1;
  desc.lump[0].node = n + 1;
  desc.lump[0].mass = FB_R(0.3);
  desc.lump[0].inertia[0] = desc.lump[0].inertia[1] = desc.lump[0].inertia[2] = FB_R(1e-3);
}

/* ---- what must be constant */

/* E10.13, E10.21, E10.22, E11.20: springs drive links to and fro, in steps that resolve bending and in steps that do
   not. */
TEST(hinges_keep_energy_whatever_the_step)
{
  for (int fast = 0; fast < (FB_SINGLE ? 1 : 2); fast++) {
    double before, worst = 0.0, swing = 0.0;
    elbow(4);
    start();
    before = total_energy();
    for (int k = 0; k < FBT_LONG(FB_SINGLE ? 10 : 50, 10); k++) {
      if (steps(100, fast ? 1e-3 : 4e-3) != FB_OK) {
        return;
      }
      worst = fmax(worst, fabs(total_energy() / before - 1.0));
      swing = fmax(swing, fabs((double)state.angle[0] - 0.3));
    }
    FBT_BELOW(0.4, swing);
    FBT_BELOW(worst, FBT_TOL(1e-10, 1e-3));
    if (fast) {
      fbt_figure("energy over 5000 steps of two elastic links on hinges with springs, relative", "constant", worst);
    }
  }
}

/* E10.14, E10.22: three links fly, the middle one between a hub and hinges about two axes: their momenta change by the
   step and the mesh alone, order 2. */
TEST(links_in_flight_keep_momentum)
{
  double change[2];
  for (int run = 0; run < 2; run++) {
    fb_momentum before, after;
    const int n = 3;
    beam(3.0, 3 * n + 2, stiff, slim);
    desc.root = FB_END_FREE;
    desc.iterations = 12;
    hinge(n, 0.0, 1.0, 0.2)->rate = FB_R(1.5);
    hinge(2 * n + 1, 0.3, 0.0, 1.0)->rate = FB_R(-2.0);
    desc.joint[0].stiffness = FB_R(0.5);
    input.w[2] = FB_R(0.7);
    start();
    FBT_INT_EQ(fb_exact_momentum_eval(&exact, &before, &state), FB_OK);
    if (steps(run ? 400 : 200, run ? 5e-3 : 1e-2) != FB_OK) {
      return;
    }
    FBT_INT_EQ(fb_exact_momentum_eval(&exact, &after, &state), FB_OK);
    change[run] = fbt_difference(after.angular, before.angular, 3) / fbt_largest(before.angular, 3) +
                  fbt_difference(after.linear, before.linear, 3);
  }
  FBT_BELOW(change[0], FBT_TOL(1e-3, 1e-2));
  FBT_TRUE(FB_SINGLE || change[1] < 0.3 * change[0]);
  fbt_figure("three rods on hinges in flight, change of momenta in 2 s at 5 ms, relative", "constant", change[1]);
}

/* E10.22: what is lost is what the dampers take at mid-step. */
TEST(a_damper_takes_what_is_lost)
{
  double before, taken = 0.0;
  elbow(3);
  desc.joint[0].damping = FB_R(0.3);
  desc.joint[1].damping = FB_R(0.1);
  start();
  before = total_energy();
  for (int k = 0; k < 500; k++) {
    if (steps(1, 2e-3) != FB_OK) {
      return;
    }
    for (int j = 0; j < 2; j++) {
      const fb_exact_hinge h = joint_of(j);
      taken += 2e-3 * (double)desc.joint[j].damping * (double)h.rate * (double)h.rate;
    }
  }
  FBT_BELOW(0.1 * before, taken);
  FBT_NEAR_REL(before - total_energy(), taken, FBT_TOL(1e-10, 1e-3));
}

/* E10.13, E11.20: with dissipation the energy of elements and springs never rises, in steps of any length. */
TEST(dissipation_takes_energy_of_springs_too)
{
  static const double rigid[6] = {0};
  for (int run = 0; run < 2; run++) {
    double before;
    elbow(3);
    desc.joint[0].stiffness = FB_R(20.0);
    if (run) { /* one stiff spring alone */
      beam(1.0, 2, rigid, slim);
      hinge(0, 0.0, 1.0, 0.0)->stiffness = FB_R(1e4);
      desc.joint[0].rest = FB_R(0.01);
      desc.iterations = 12;
    }
    desc.dissipation = FB_R(0.4);
    start();
    before = total_energy();
    for (int k = 0; k < 300; k++) {
      double now;
      if (steps(1, k % 2 ? 5e-3 : 1e-3) != FB_OK) {
        return;
      }
      now = total_energy();
      FBT_TRUE(now <= before * (1.0 + FBT_TOL(1e-12, 1e-4)));
      before = now;
    }
  }
}

/* ---- against rigid bodies, another program, and closed forms */

static fb_body rod_body;
static fb_system rods;
static fb_system_desc rods_desc;
static fb_system_state rods_state;
static fb_system_work rods_work;

/* Two rods of 1 m as bodies on revolute joints about axes a and b, at the angles and rates of the desc. */
static void rods_start(const fb_real a[3], const fb_real b[3], double mass, const double J_x[3])
{
  static fb_shape shape;
  static fb_body_work body_work;
  static fb_body_desc body_desc;
  static fb_link_motion first[FB_MAX_BODIES];
  const fb_real center[3] = {FB_R(0.5), 0, 0}, tip[3] = {FB_R(1.0), 0, 0};
  const fb_real J[6] = {(fb_real)J_x[0], (fb_real)(mass / 12.0 + J_x[1]), (fb_real)(mass / 12.0 + J_x[2]), 0, 0, 0};
  int end;
  memset(&rods_desc, 0, sizeof rods_desc);
  memset(&body_desc, 0, sizeof body_desc);
  body_desc.base = FB_BASE_PRESCRIBED;
  body_desc.effects = FB_EFFECT_GRAVITY;
  body_desc.gravity[2] = desc.gravity[2];
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)mass, center, J), FB_OK);
  FBT_INT_EQ(fb_shape_add_node(&shape, &end, tip, NULL, NULL), FB_OK);
  FBT_INT_EQ(fb_body_init(&rod_body, &body_work, &shape, &body_desc), FB_OK);
  rods_desc.n_body = 2;
  for (int k = 0; k < 2; k++) {
    fb_joint_desc *const joint = &rods_desc.joint[k];
    joint->kind = FB_JOINT_REVOLUTE;
    joint->parent = k ? 0 : FB_GROUND;
    joint->parent_node = k ? end : 0;
    memcpy(joint->axis, k ? b : a, sizeof joint->axis);
    joint->stiffness[0] = desc.joint[k].stiffness;
    joint->rest[0] = desc.joint[k].rest;
    joint->damping[0] = desc.joint[k].damping;
    first[k].value[0] = desc.joint[k].angle;
    first[k].speed[0] = desc.joint[k].rate;
  }
  FBT_INT_EQ(fb_system_init(&rods, &rods_work, &rod_body, &rods_desc, 1), FB_OK);
  FBT_INT_EQ(fb_system_state_init(&rods, &rod_body, &rods_state, &rods_work, first, NULL), FB_OK);
}

/* E10.21 to E10.25, E11.20: two rods on hinges about skew axes with springs and dampers under gravity, against two rigid
   bodies on revolute joints; the step's error is of order 2. */
TEST(rods_on_joints_move_as_bodies_of_a_system)
{
  static const double rigid[6] = {0};
  const double dt = FBT_TOL(2e-3, 4e-3);
  double apart[3];
  for (int run = 0; run < 3; run++) {
    const int fine = 1 << run;
    double worst = 0.0;
    beam(2.0, 4, rigid, slim);
    desc.iterations = 10;
    desc.gravity[2] = FB_R(-9.81);
    hinge(0, 0.0, 1.0, 0.3)->rate = FB_R(2.0);
    hinge(2, 0.2, 0.5, 1.0)->rate = FB_R(-1.0);
    for (int k = 0; k < 2; k++) {
      desc.joint[k].angle = (fb_real)(0.4 + k);
      desc.joint[k].stiffness = (fb_real)(2.0 - k);
      desc.joint[k].rest = FB_R(0.5);
      desc.joint[k].damping = FB_R(0.05);
    }
    start();
    rods_start(desc.joint[0].axis, desc.joint[1].axis, slim[0], slim + 3);
    for (int k = 0; k < 500; k++) {
      if (steps(fine, dt / fine) != FB_OK) {
        return;
      }
      FBT_INT_EQ(fb_system_rk4_step(&rods, &rod_body, &rods_state, &rods_work, NULL, NULL, NULL, (fb_real)dt), FB_OK);
      for (int j = 0; j < 2; j++) {
        worst = fmax(worst, fabs((double)(state.angle[j] - rods_state.link[j].x[0])));
      }
    }
    apart[run] = worst;
  }
  FBT_BELOW(apart[2], FBT_TOL(1e-5, 1e-2));
  FBT_TRUE(FB_SINGLE || fabs(log2(apart[0] / apart[1]) - 2.0) < 0.2);
  fbt_figure("double pendulum of rods about skew axes, 1 s at 0.5 ms [rad]", "two rigid bodies", apart[2]);
}

/* E10.21, E10.22 on p11: a double pendulum of very flexible links falls from the horizontal. */
TEST(elastic_links_follow_the_reference)
{
  const fbt_table *table = fbt_reference("p11_double_pendulum.csv");
  const double stiffness[6] = {2e4, 0.0, 0.0, 100.0, 100.0, 2.0}, inertia[6] = {0.5, 0.5, 0.5, 0.0, 0.0, 0.0};
  double worst = 0.0;
  beam(2.0, 34, stiffness, inertia);
  desc.gravity[1] = FB_R(-9.81);
  hinge(0, 0.0, 0.0, 1.0);
  hinge(17, 0.0, 0.0, 1.0);
  start();
  for (int row = 1; row < table->rows && fbt_value(table, row, "t") < FBT_LONG(1.51, 0.31); row++) {
    const double T = fbt_value(table, row, "t") - fbt_value(table, row - 1, "t");
    const int n = (int)ceil(T / FBT_TOL(2e-4, 2e-3));
    if (steps(n, T / n) != FB_OK) {
      return;
    }
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    worst = fmax(worst, hypot((double)node[34].position[0] - fbt_value(table, row, "tip_x"),
                              (double)node[34].position[1] - fbt_value(table, row, "tip_y")));
    worst = fmax(worst, hypot((double)node[17].position[0] - fbt_value(table, row, "hinge_x"),
                              (double)node[17].position[1] - fbt_value(table, row, "hinge_y")));
  }
  FBT_BELOW(worst, FBT_TOL(1e-3, 2e-2));
  fbt_figure("double pendulum of flexible links, tip and hinge to 1.5 s [link lengths]", "p11_double_pendulum.csv",
             worst);
}

/* E10.21, E10.22, E10.25 on p11: a driven crank, almost rigid and without mass, a flexible rod, a slider. */
TEST(a_slider_crank_follows_the_reference)
{
  const fbt_table *table = fbt_reference("p11_slider_crank.csv");
  const double a = 0.15, L = 0.3, spin = 150.0;
  const double rod[6] = {1.28e7, 0.0, 0.0, 100.0, 100.0, 68.2666666667},
               inertia[6] = {0.50368, 0.50368, 0.50368, 0, 0, 0};
  const int n = 16;
  double slider = 0.0, middle = 0.0;
  fb_exact_joint *joint;
  beam(a + L, n + 3, rod, inertia);
  desc.n_station = 4;
  for (int k = 3; k >= 0; k--) {
    desc.station[k] = desc.station[0];
    desc.station[k].x = (fb_real)(k == 0 ? 0.0 : k == 1 ? a : k == 2 ? a + 1e-6 : a + L);
    for (int i = 0; i < 36 && k < 2; i++) {
      desc.station[k].stiffness[i] *= FB_R(1e4);
      desc.station[k].inertia[i] *= FB_R(1e-6);
    }
  }
  for (int k = 1; k <= n + 3; k++) {
    desc.place[k] = (fb_real)(k < 2 ? 0.0 : k < 4 ? a : a + L * (k - 3) / n);
  }
  joint = hinge(0, 0.0, 0.0, 1.0);
  joint->driven = 1;
  joint->rate = input.motor[0] = (fb_real)spin;
  hinge(2, 0.0, 0.0, 1.0)->rate = (fb_real)(-spin - a * spin / L);
  desc.tip = FB_HOLD_Y | FB_HOLD_Z;
  desc.n_lump = 1;
  desc.lump[0].node = n + 3;
  desc.lump[0].mass = FB_R(0.075552);
  start();
  for (int row = 1; row < table->rows; row++) {
    const double T = fbt_value(table, row, "t") - fbt_value(table, row - 1, "t");
    const int parts = (int)ceil(T / FBT_TOL(1e-5, 4e-5));
    if (steps(parts, T / parts) != FB_OK) {
      return;
    }
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    slider = fmax(slider, fabs((double)node[n + 3].position[0] - fbt_value(table, row, "slider_x")));
    middle = fmax(middle, hypot((double)node[3 + n / 2].position[0] - fbt_value(table, row, "mid_x"),
                                (double)node[3 + n / 2].position[1] - fbt_value(table, row, "mid_y")));
  }
  FBT_BELOW(slider, FBT_TOL(1e-4, 1e-2));
  FBT_BELOW(middle, FBT_TOL(1e-4, 1e-2));
  fbt_figure("slider-crank with a flexible rod, its middle [m]", "p11_slider_crank.csv", middle);
}

/* E10.21, E10.22: a shaft drives another, 40 degrees off, by a universal joint, two hinges without anything between them:
   tan(out) = tan(in)/cos(40 degrees) over whole turns, once what the start has shaken is gone. */
TEST(a_universal_joint_turns_as_cardan_says)
{
  const double bend = 0.7;
  double worst = 0.0;
  beam(2.0, 7, stiff, slim);
  for (int i = 0; i < 3; i++) {
    desc.station[0].stiffness[7 * i] = FB_R(1e6);
  }
  hinge(0, 1.0, 0.0, 0.0)->driven = 1;
  input.motor[0] = FB_R(3.0);
  hinge(3, 0.0, 1.0, 0.0);
  hinge(4, 0.0, 0.0, 1.0)->angle = (fb_real)bend;
  desc.n_support = 1;
  desc.support[0].node = 3;
  desc.support[0].held = FB_HOLD_Y | FB_HOLD_Z;
  desc.tip = FB_END_PINNED;
  desc.iterations = 10;
  desc.dissipation = FB_R(0.6);
  start();
  for (int k = 0; k < 1500; k++) {
    fb_real R[9];
    double in, out;
    if (steps(1, 4e-3) != FB_OK) {
      return;
    }
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    in = (double)joint_of(0).angle;
    FBT_NEAR_REL(in, 0.012 * (k + 1), FBT_TOL(1e-11, 1e-4));
    fb_quat_to_mat33(R, node[7].quat); /* of its y and z axes that to the normal of the plane of both */
    out = atan2((double)R[7], (double)R[8]);
    worst = k > 500 ? fmax(worst, fabs(sin(out - atan2(sin(in), cos(in) * cos(bend))))) : 0.0;
  }
  FBT_BELOW(worst, FBT_TOL(1e-5, 1e-2));
  fbt_figure("universal joint of two hinges, 40 degrees, shaft against shaft [rad]", "Cardan", worst);
}

/* E10.22, E10.25: a motor spins a rotor on a joint up, in closed form, through whole turns, which the rotation of its
   nodes counts; the energy is the work of the motor. */
TEST(a_motor_spins_up_through_whole_turns)
{
  static const double rigid[6] = {0};
  const double J = slim[3] * 0.5, torque = 0.02;
  beam(1.0, 3, rigid, slim);
  hinge(1, -3.0, 0.0, 0.0);
  input.motor[0] = (fb_real)-torque; /* about -x */
  start();
  if (steps(1500, 1e-3) == FB_OK) {
    const fb_exact_hinge h = joint_of(0);
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    FBT_NEAR_REL(h.angle, -0.5 * torque / J * 2.25, FBT_TOL(1e-9, 1e-3));
    FBT_NEAR_REL(h.rate, -torque / J * (1.5 - 0.5e-3), FBT_TOL(1e-9, 1e-3));
    FBT_NEAR_REL(h.moment, -torque, FBT_TOL(1e-9, 1e-3));
    FBT_BELOW(14.0, -h.angle);
    FBT_NEAR_REL(node[3].rotation[0], -(double)h.angle, FBT_TOL(1e-7, 1e-3));
    FBT_NEAR_REL(total_energy(), torque * fabs((double)h.angle), FBT_TOL(1e-9, 1e-3));
  }
}

/* ---- steady states */

/* E10.21, E10.22: a rod on a spring at its hinge under a dead force across and a motor: stiffness (angle - rest) = force
   length cos(angle) + motor, about an axis of either sign. */
TEST(a_spring_at_a_hinge_bears_the_load)
{
  for (int run = 0; run < 4; run++) {
    const double sign = run % 2 ? -1.0 : 1.0, k = 3.0, force = 2.0, rest = 0.2, torque = 0.4;
    static const double rigid[6] = {0};
    fb_exact_joint *joint;
    beam(1.5, 3, rigid, slim);
    joint = hinge(run / 2, 0.0, 0.0, sign);
    joint->stiffness = (fb_real)k;
    joint->rest = (fb_real)(sign * rest);
    joint->damping = FB_R(7.0); /* at rest there is none */
    load_tip(FB_AXES_INERTIAL, 0.0, force, 0.0);
    input.motor[0] = (fb_real)(sign * torque);
    settle();
    {
      const double angle = sign * (double)joint_of(0).angle, arm = run / 2 ? 0.75 : 1.5;
      FBT_BELOW(0.5, angle);
      FBT_NEAR_REL(k * (angle - rest), force * arm * cos(angle) + torque, FBT_TOL(1e-9, 1e-4));
      FBT_NEAR_REL(node[3].position[1], arm * sin(angle), FBT_TOL(1e-9, 1e-4));
      FBT_NEAR_REL(node[0].moment[2], force * ((run / 2 ? 0.75 : 0.0) + arm * cos(angle)), FBT_TOL(1e-8, 1e-4));
      FBT_INT_EQ(work.unstable, 0);
    }
  }
}

/* E10.11, E10.22: a driven joint rests at the angle of the state, which may be set; from far away the load comes in
   increments. */
TEST(driven_joints_rest_where_they_are_told)
{
  for (int run = 0; run < 3; run++) {
    const double angle = run == 0 ? 0.5 : run == 1 ? -2.5 : 7.0, force = 0.5;
    beam(2.0, 7, stiff, slim);
    hinge(3, 0.0, 0.0, 1.0)->driven = 1;
    load_tip(FB_AXES_INERTIAL, 0.0, force, 0.0);
    start();
    state.angle[0] = (fb_real)angle;
    FBT_INT_EQ(fb_exact_trim(&exact, &state, &work, &input), FB_OK);
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    FBT_NEAR_REL(joint_of(0).angle, angle, FBT_TOL(1e-12, 1e-5));
    FBT_NEAR_ABS(node[7].position[1], sin(angle), 1e-3);
    FBT_NEAR_ABS(joint_of(0).moment, -force * cos(angle), 1e-3);
    FBT_NEAR_ABS(node[7].rotation[2], angle, 1e-3);
  }
}

/* Cantilever under dead loads that bend it far and twist it; its middle a joint: 1: driven, locked at the angle it was
   built with, 2: stiff, 0: none. */
static double locked(int kind, fb_real tip[3])
{
  const double stiffness[6] = {1e4, 4e3, 4e3, 0.8, 1.0, 1.5};
  double energy;
  beam(1.0, kind ? 9 : 8, stiffness, slim);
  if (kind) {
    fb_exact_joint *const joint = hinge(4, 0.3, 0.5, 1.0);
    joint->driven = kind == 1;
    joint->stiffness = kind == 1 ? FB_R(0.0) : (fb_real)FBT_TOL(1e9, 1e5);
  }
  desc.iterations = 12;
  load_tip(FB_AXES_INERTIAL, -0.3, 2.0, 1.0);
  input.load[0].torque[0] = FB_R(0.3);
  settle();
  FBT_INT_EQ(work.unstable, 0);
  input.n_load = 0;
  if (steps(50, 5e-3) != FB_OK) {
    return 0.0;
  }
  FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
  memcpy(tip, node[desc.n_element].position, 3 * sizeof *tip);
  energy = total_energy();
  return energy;
}

/* E10.21 to E10.23: a beam with a locked joint in it, or one with a very stiff spring, is the beam without, bent and
   let go. */
TEST(a_locked_or_stiff_joint_is_no_joint)
{
  fb_real none[3] = {0}, other[3] = {0};
  const double energy = locked(0, none);
  for (int kind = 1; kind < 3; kind++) {
    FBT_NEAR_REL(locked(kind, other), energy, FBT_TOL(kind == 1 ? 1e-11 : 1e-8, 1e-3));
    FBT_BELOW(fbt_difference(none, other, 3), FBT_TOL(kind == 1 ? 1e-10 : 1e-7, 1e-3));
  }
}

/* E10.23: two joints about skew axes, spin, gravity, loads, a lumped body: from a solution nearby four corrections reach
   rounding. */
TEST(newton_of_hinges_converges_quadratically)
{
  elbow(3);
  desc.joint[0].stiffness = FB_R(20.0);
  desc.joint[1].stiffness = FB_R(15.0);
  desc.gravity[1] = FB_R(-1.0);
  desc.gravity[2] = FB_R(2.0);
  input.w[0] = FB_R(0.3);
  input.w[2] = FB_R(1.2);
  load_tip(FB_AXES_INERTIAL, 1.3, -2.5, 1.4);
  load_tip(FB_AXES_NODE, 1.3, 1.2, 1.4);
  input.motor[0] = FB_R(1.0);
  input.motor[1] = FB_R(-2.0);
  settle();
  input.load[0].force[1] += FB_R(0.3);
  input.w[2] += FB_R(0.05);
  input.motor[1] += FB_R(0.3);
  FBT_INT_EQ(fb_exact_trim(&exact, &state, &work, &input), FB_OK);
  FBT_INT_EQ(work.increments, 1);
  FBT_TRUE(work.iterations <= 4);
}

/* E10.23, E11.20: marching, too, at 30 rad/s in steps of 5 ms: three corrections with the tangent of their own. */
TEST(steps_of_hinges_converge_with_their_tangent)
{
  static fb_exact_state exactly;
  for (int run = 0; run < 2; run++) {
    elbow(3);
    desc.joint[1].rate = FB_R(30.0);
    desc.iterations = run ? 1 : 20;
    desc.factorizations = run ? 3 : 1;
    start();
    FBT_INT_EQ(fb_exact_step(&exact, &state, &work, &input, FB_R(5e-3)), FB_OK);
    exactly = run ? exactly : state;
  }
  FBT_BELOW(1.0, fbt_largest(exactly.V[0], 6 * (exact.n + 1)));
  FBT_BELOW(fbt_difference(state.V[0], exactly.V[0], 6 * (exact.n + 1)), FBT_TOL(1e-12, 1e-3));
}

/* E10.24: two stiff bars in line, a hinge with a spring between them, the ends pinned: unstable beyond 4 stiffness/length,
   about any axis across; never, if the joint is driven. */
TEST(a_hinged_column_buckles_at_its_load)
{
  const double EI = FBT_TOL(1e6, 3e3), EA = FBT_TOL(1e7, 1e4), k = 3.0, L = 2.0;
  const double stiffness[6] = {EA, EA, EA, EI, EI, EI};
  for (int run = 0; run < 12; run++) {
    const double part = run % 2 ? 1.0 + FBT_TOL(0.01, 0.1) : 1.0 - FBT_TOL(0.01, 0.1), tilt = 0.5 * (run / 2 % 3);
    fb_exact_joint *joint;
    beam(L, 5, stiffness, NULL);
    desc.root = FB_END_PINNED | FB_HOLD_RX;
    desc.tip = FB_HOLD_Y | FB_HOLD_Z;
    joint = hinge(2, 0.0, sin(tilt), cos(tilt));
    joint->stiffness = (fb_real)k;
    joint->driven = run >= 6;
    load_tip(FB_AXES_INERTIAL, -part * 4.0 * k / L, 0.0, 0.0);
    settle();
    FBT_INT_EQ(work.unstable, run >= 6 ? 0 : run % 2);
  }
}

/* E12.17: along a path of growing motor torque the spring has the angle that bears it. */
TEST(paths_follow_a_motor)
{
  static fb_exact_path path;
  static fb_exact_path_work path_work;
  static fb_exact_input varied;
  memset(&path, 0, sizeof path);
  memset(&varied, 0, sizeof varied);
  beam(1.0, 4, stiff, slim);
  hinge(2, 0.0, 1.0, 0.0)->stiffness = FB_R(2.0);
  varied.motor[0] = FB_R(5.0);
  settle();
  for (int k = 0; k < 30; k++) {
    FBT_INT_EQ(fb_exact_path_step(&exact, &path, &state, &path_work, &input, &varied, FB_R(0.1)), FB_OK);
    FBT_NEAR_REL(joint_of(0).angle, 2.5 * (double)path.factor, FBT_TOL(1e-9, 1e-4));
  }
  FBT_BELOW(3.2, joint_of(0).angle);
}

/* ---- linear models */

/* E10.21 to E10.23, E12.4: a stiff blade on a flap and a lag hinge at e of the radius, one behind the other: flap at
   sqrt(1 + 3/2 e/(1 - e)) of the spin, lag at sqrt(3/2 e/(1 - e)), damped by its damper as in closed form. */
TEST(hinged_blades_flap_and_lag_in_closed_form)
{
  static const double rigid[6] = {0}, line[6] = {2.0, 2.0, 2.0, 1e-9, 0.0, 0.0};
  double worst = 0.0;
  for (int run = 0; run < 4; run++) {
    const double e = 0.05 + 0.05 * run, R = 5.0, spin = 20.0, L = R * (1.0 - e), J = line[0] * L * L * L / 3.0;
    const double damping = run % 2 ? 0.2 * J * spin : 0.0, loss = 0.5 * damping / J;
    const double lag = sqrt(1.5 * e / (1.0 - e)) * spin, flap = sqrt(spin * spin + lag * lag);
    beam(L, 4, rigid, line);
    desc.position[0] = (fb_real)(e * R);
    hinge(0, 0.0, 1.0, 0.0);
    hinge(1, 0.0, 0.0, 1.0)->damping = (fb_real)damping;
    input.w[2] = (fb_real)spin;
    settle();
    FBT_INT_EQ(work.unstable, 0);
    spectrum_of(2);
    worst = fmax(worst, fabs((double)spectrum.im[0] / sqrt(lag * lag - loss * loss) - 1.0));
    worst = fmax(worst, fabs((double)spectrum.im[1] / flap - 1.0));
    worst = fmax(worst, fabs((double)spectrum.re[0] + loss) / spin);
  }
  FBT_BELOW(worst, FBT_TOL(1e-8, 1e-3));
  fbt_figure("stiff blade on flap and lag hinges, frequencies and damping, relative", "closed form", worst);
}

/* E10.22, E12.13: from the motor of a hinge with spring and damper to its angle and rate: 1/(J s^2 + c s + k). */
TEST(linear_joints_answer_their_motor)
{
  static fb_exact_linear linear;
  static fb_exact_linear_work linear_work;
  static fb_linear_desc ports;
  static const double rigid[6] = {0}, line[6] = {2.0, 2.0, 2.0, 1e-9, 0.0, 0.0};
  const double L = 1.5, J = line[0] * L * L * L / 3.0, k = 40.0, c = 1.5;
  memset(&ports, 0, sizeof ports);
  beam(L, 3, rigid, line);
  hinge(0, 0.0, 1.0, 0.0)->stiffness = (fb_real)k;
  desc.joint[0].damping = (fb_real)c;
  settle();
  ports.n_in = 1;
  ports.n_out = 2;
  ports.in[0].kind = FB_PORT_DRIVE;
  ports.out[0].kind = FB_PORT_COORDINATE;
  ports.out[1].kind = FB_PORT_SPEED;
  FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &state, &input, &ports, 1), FB_OK);
  FBT_INT_EQ(linear.n, 2);
  FBT_NEAR_REL(linear.re[0], -0.5 * c / J, FBT_TOL(1e-7, 1e-2));
  FBT_NEAR_REL(linear.im[0], sqrt(k / J - 0.25 * c * c / (J * J)), FBT_TOL(1e-8, 1e-3));
  { /* first moments: C B is 0 for the angle, 1/J for the rate; -C A^-1 B + D is 1/k */
    const fb_real *const A = linear.A, *const B = linear.B, *const C = linear.C;
    const double det = (double)(A[0] * A[3] - A[1] * A[2]);
    const double x = (double)(A[3] * B[0] - A[1] * B[1]) / det, y = (double)(A[0] * B[1] - A[2] * B[0]) / det;
    FBT_NEAR_ABS(C[0] * B[0] + C[1] * B[1], 0.0, FBT_TOL(1e-8, 1e-3) / J);
    FBT_NEAR_REL(C[2] * B[0] + C[3] * B[1], 1.0 / J, FBT_TOL(1e-7, 1e-3));
    FBT_NEAR_REL((double)linear.D[0] - (double)C[0] * x - (double)C[1] * y, 1.0 / k, FBT_TOL(1e-8, 1e-3));
  }
  desc.joint[0].driven = 1;
  settle();
  FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &state, &input, &ports, 1), FB_ERR_UNSUPPORTED);
  ports.in[0].body = 1;
  FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &state, &input, &ports, 1), FB_ERR_CAPACITY);
}

/* ---- refusals */

/* E10.21: what a joint may not be, by name; a free hinge that nothing holds has no steady state, and moves. */
TEST(joints_that_cannot_be_are_refused)
{
  static const char *const word[] = {"element", "axis", "another", "all joints", "stiffness", "damping", "angle",
                                     "held",    "held", "place",   "rest",       "rate",      "n_joint"};
  static fb_exact_state before;
  for (int bad = 0; bad < FBT_COUNT(word); bad++) {
    beam(1.0, bad == 3 ? 2 : 4, stiff, slim);
    hinge(1, 0.0, 1.0, 0.0);
    hinge(bad == 2 ? 1 : bad == 3 ? 0 : 2, 0.0, 0.0, 1.0);
    desc.joint[1].element = bad == 0 ? 4 : desc.joint[1].element;
    desc.joint[1].axis[2] = bad == 1 ? FB_R(0.0) : FB_R(1.0);
    desc.joint[1].stiffness = bad == 4 ? FB_R(-1.0) : FB_R(1.0);
    desc.joint[1].damping = bad == 5 ? FB_R(-1.0) : FB_R(1.0);
    desc.joint[1].angle = bad == 6 ? FB_R(1e7) : FB_R(1.0);
    desc.tip = bad == 7 ? FB_END_PINNED : FB_END_FREE;
    desc.joint[1].element = bad == 7 ? 3 : desc.joint[1].element;
    desc.n_support = bad == 8;
    desc.support[0].node = bad == 8 ? 3 : 0;
    desc.support[0].held = bad == 8 ? FB_HOLD_Y : 0;
    for (int k = 0; k < 5 && bad == 9; k++) {
      desc.place[k] = (fb_real)(0.25 * k);
    }
    desc.joint[1].rest = bad == 10 ? (fb_real)NAN : FB_R(0.0);
    desc.joint[1].rate = bad == 11 ? (fb_real)INFINITY : FB_R(0.0);
    desc.n_joint = bad == 12 ? FB_MAX_LUMPS + 1 : 2;
    FBT_INT_EQ(fb_exact_init(&exact, &desc), bad == 0 || bad == 12    ? FB_ERR_CAPACITY
                                             : bad == 10 || bad == 11 ? FB_ERR_NOT_FINITE
                                                                      : FB_ERR_VALUE);
  }
  beam(1.0, 4, stiff, slim);
  hinge(1, 0.0, 1.0, 0.0);
  start();
  before = state;
  FBT_INT_EQ(fb_exact_trim(&exact, &state, &work, &input), FB_ERR_SINGULAR);
  input.line[1].force[1] = FB_R(1.0);
  FBT_INT_EQ(fb_exact_step(&exact, &state, &work, &input, FB_R(0.01)), FB_ERR_VALUE);
  input.line[1].force[1] = FB_R(0.0);
  input.motor[0] = (fb_real)NAN;
  FBT_INT_EQ(fb_exact_step(&exact, &state, &work, &input, FB_R(0.01)), FB_ERR_NOT_FINITE);
  input.motor[0] = FB_R(1.0);
  desc.joint[0].driven = 1;
  FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_OK);
  FBT_INT_EQ(fb_exact_trim(&exact, &state, &work, &input), FB_ERR_VALUE);
  FBT_TRUE(memcmp(&before, &state, sizeof state) == 0);
  {
    fb_exact_hinge h;
    FBT_INT_EQ(fb_exact_joint_eval(&exact, &h, &state, 1), FB_ERR_CAPACITY);
    FBT_INT_EQ(fb_exact_joint_eval(&exact, &h, &state, -1), FB_ERR_CAPACITY);
    FBT_INT_EQ(fb_exact_joint_eval(&exact, NULL, &state, 0), FB_ERR_NULL);
  }
  state.angle[0] = FB_R(2e9);
  FBT_INT_EQ(fb_exact_state_check(&exact, &state), FB_ERR_VALUE);
  exact.jointed[2] = 1;
  FBT_INT_EQ(fb_exact_check(&exact), FB_ERR_VALUE);
}

/* fb_exact_point_eval, E10.12: at a joint, also one at the root, the line goes on. */
TEST(points_pass_joints)
{
  const double bend = 0.5;
  beam(2.0, 6, stiff, slim);
  hinge(0, 0.0, 0.0, 1.0)->angle = (fb_real)bend;
  hinge(3, 0.0, 0.0, 1.0)->angle = (fb_real)bend;
  start();
  for (int k = 0; k <= 8; k++) {
    const double x = 0.25 * k, first = x < 1.0 ? x : 1.0, second = x - first;
    fb_real r[3], q[4];
    FBT_INT_EQ(fb_exact_point_eval(&exact, r, q, &state, (fb_real)x), FB_OK);
    FBT_BELOW(
        distance(r, first * cos(bend) + second * cos(2.0 * bend), first * sin(bend) + second * sin(2.0 * bend), 0.0),
        FBT_TOL(1e-12, 1e-5));
  }
}

SUITE(exact_joints, RUN(hinges_keep_energy_whatever_the_step), RUN(links_in_flight_keep_momentum),
      RUN(a_damper_takes_what_is_lost), RUN(dissipation_takes_energy_of_springs_too),
      RUN(driven_joints_rest_where_they_are_told), RUN(rods_on_joints_move_as_bodies_of_a_system),
      RUN_LONG(elastic_links_follow_the_reference), RUN_LONG(a_slider_crank_follows_the_reference),
      RUN(a_universal_joint_turns_as_cardan_says), RUN(a_motor_spins_up_through_whole_turns),
      RUN(a_spring_at_a_hinge_bears_the_load), RUN(a_locked_or_stiff_joint_is_no_joint),
      RUN(newton_of_hinges_converges_quadratically), RUN(steps_of_hinges_converge_with_their_tangent),
      RUN(a_hinged_column_buckles_at_its_load), RUN(paths_follow_a_motor),
      RUN(hinged_blades_flap_and_lag_in_closed_form), RUN(linear_joints_answer_their_motor),
      RUN(joints_that_cannot_be_are_refused), RUN(points_pass_joints))
