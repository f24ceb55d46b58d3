/* >>exact: the exact beam in free flight: momentum, rigid motion, falls. */
#include "exact.h"

/* ---- the same beam seen another way: 1: with y for z, turned by a right angle about its line, 2: from its other end,
   turned by half a turn about z */

/* A beam that tumbles, or is held at its root, pushed across at its tip for a second, at a speed along (0.6, 0.8, 0):
   two seconds. */
static void fly(int held, double speed)
{
  const double stiffness[6] = {1e4, 4e3, 4e3, 80.0, 100.0, 100.0}, inertia[6] = {1.0, 1.0, 1.0, 2e-2, 1e-2, 1e-2};
  fb_status status = FB_OK;
  beam(5.0, 8, stiffness, inertia);
  desc.root = held ? FB_END_CLAMPED : FB_END_FREE;
  desc.dissipation = held ? FB_R(0.2) : FB_R(0.0);
  desc.n_lump = 1;
  desc.lump[0].node = 8;
  desc.lump[0].mass = FB_R(0.3);
  input.v[0] = (fb_real)(0.6 * speed);
  input.v[1] = (fb_real)(0.8 * speed);
  input.w[0] = held ? FB_R(0.0) : FB_R(0.3);
  input.w[2] = held ? FB_R(0.0) : FB_R(1.0);
  start();
  load_tip(FB_AXES_NODE, 0.0, 2.0, 1.0);
  for (int k = 0; k < 400 && status == FB_OK; k++) {
    input.n_load = k < 200;
    status = fb_exact_step(&exact, &state, &work, &input, FB_R(0.005));
  }
  FBT_INT_EQ(status, FB_OK);
  FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
}

/* E10.13, E10.14, E11.33: the equations know no speed: the same motion beside a constant velocity, on top of which
   place, velocities, momenta and energy stand. */
TEST(flight_at_any_speed_moves_as_rest_does)
{
  const double speed[4] = {100.0, 250.0, 7500.0, 30000.0};
  static fb_exact_node rest[FB_MAX_EXACT + 1];
  for (int run = 0; run < 8; run++) {
    const int held = run / 4;
    const double v = speed[run % 4], mass = 5.3, rounding = 8.0 * (double)FB_EPSILON;
    fb_momentum p[2];
    fb_energy energy[2];
    fb_exact_element element[2];
    fly(held, 0.0);
    memcpy(rest, node, sizeof rest);
    FBT_INT_EQ(fb_exact_momentum_eval(&exact, &p[0], &state), FB_OK);
    FBT_INT_EQ(fb_exact_energy_eval(&exact, &energy[0], &state), FB_OK);
    FBT_INT_EQ(fb_exact_element_eval(&exact, &element[0], &state, 3), FB_OK);
    fly(held, v);
    FBT_INT_EQ(fb_exact_momentum_eval(&exact, &p[1], &state), FB_OK);
    FBT_INT_EQ(fb_exact_energy_eval(&exact, &energy[1], &state), FB_OK);
    FBT_INT_EQ(fb_exact_element_eval(&exact, &element[1], &state, 3), FB_OK);
    for (int j = 0; j <= 8; j++) {
      fb_real R[9], seen[3], going[3] = {0};
      going[0] = (fb_real)(0.6 * v);
      going[1] = (fb_real)(0.8 * v);
      fb_quat_to_mat33(R, node[j].quat);
      fb_mat33_mulT_vec3(seen, R, going);
      FBT_BELOW(fbt_difference(node[j].displacement, rest[j].displacement, 3) / 5.0, FBT_TOL(1e-9, 2e-5));
      FBT_BELOW(fbt_difference(node[j].quat, rest[j].quat, 4), FBT_TOL(1e-9, 2e-5));
      for (int i = 0; i < 3; i++) {
        FBT_NEAR_ABS((double)node[j].position[i] - 2.0 * (double)going[i], (double)rest[j].position[i],
                     FBT_TOL(1e-9, 1e-4) * 5.0 + rounding * 2.0 * v);
        FBT_NEAR_ABS((double)node[j].velocity[i] - (double)seen[i], (double)rest[j].velocity[i],
                     FBT_TOL(1e-9, 1e-4) * 5.0 + rounding * v);
        FBT_NEAR_ABS((double)p[1].linear[i] - mass * (double)going[i], (double)p[0].linear[i],
                     FBT_TOL(1e-9, 1e-4) * 5.0 + rounding * mass * v);
      }
    }
    FBT_NEAR_REL(energy[1].kinetic,
                 (double)energy[0].kinetic + 0.6 * v * (double)p[0].linear[0] + 0.8 * v * (double)p[0].linear[1] +
                     0.5 * mass * v * v,
                 FBT_TOL(1e-12, 1e-5));
    FBT_NEAR_REL(energy[1].strain, energy[0].strain, FBT_TOL(1e-8, 1e-3));
    FBT_NEAR_REL(
        hypot((double)element[1].velocity[0], hypot((double)element[1].velocity[1], (double)element[1].velocity[2])), v,
        0.1);
    FBT_NEAR_REL(
        hypot((double)element[1].momentum[0], hypot((double)element[1].momentum[1], (double)element[1].momentum[2])), v,
        0.1); /* 1 kg/m */
  }
}

/* E11.33: a tumbling beam falls for ten seconds, a held one on a base that does: the frame comes along, so that no
   velocity of the state grows, and momentum and way are those of the fall. */
TEST(thrust_takes_the_frame_along)
{
  const double stiffness[6] = {1e4, 4e3, 4e3, 80.0, 100.0, 100.0}, inertia[6] = {1.0, 1.0, 1.0, 2e-2, 1e-2, 1e-2};
  for (int held = 0; held < 2; held++) {
    fb_momentum p;
    fb_status status = FB_OK;
    double start_p, largest = 0.0;
    beam(5.0, 8, stiffness, inertia);
    desc.root = held ? FB_END_CLAMPED : FB_END_FREE;
    desc.n_lump = 1;
    desc.lump[0].node = 3;
    desc.lump[0].mass = FB_R(0.2);
    desc.gravity[2] = FB_R(-9.81);
    desc.dissipation = FB_R(0.3);
    input.w[2] = held ? FB_R(0.0) : FB_R(1.0);
    start();
    FBT_INT_EQ(fb_exact_momentum_eval(&exact, &p, &state), FB_OK);
    start_p = (double)p.linear[2];
    for (int k = 0; k < 2000 && status == FB_OK; k++) {
      input.v[2] = held ? (fb_real)(-9.81 * 0.005 * (k + 0.5)) : FB_R(0.0);
      status = fb_exact_step(&exact, &state, &work, &input, FB_R(0.005));
      largest = fmax(largest, fbt_largest(state.V[0], 54));
    }
    FBT_INT_EQ(status, FB_OK);
    FBT_BELOW(largest, 6.0); /* of 5 m in 11 s, the spin among it */
    FBT_INT_EQ(fb_exact_momentum_eval(&exact, &p, &state), FB_OK);
    FBT_NEAR_REL((double)p.linear[2] - start_p, -98.1 * 5.2, FBT_TOL(held ? 1e-3 : 2e-7, 1e-3));
    FBT_NEAR_REL(state.base_position[2], -490.5, FBT_TOL(2e-7, 2e-5));
  }
}

/* E10.14, E11.33: a free beam that is pushed across at its tip takes up the impulse of the push, and of its moment, as
   far as the header says. */
TEST(pushed_beams_take_up_the_impulse)
{
  const double stiffness[6] = {1e4, 4e3, 4e3, 80.0, 100.0, 100.0}, inertia[6] = {1.0, 1.0, 1.0, 2e-2, 1e-2, 1e-2};
  for (int fine = 0; fine < 2; fine++) {
    const int n = fine ? 20 : 10;
    double angular = 0.0, linear_off = 0.0, angular_off = 0.0;
    beam(5.0, n, stiffness, inertia);
    desc.root = FB_END_FREE;
    desc.iterations = 15;
    start();
    load_tip(FB_AXES_INERTIAL, 0.0, 50.0, 0.0);
    for (int k = 0; k < 1200; k++) {
      fb_momentum p;
      double arm;
      input.n_load = k < 200;
      FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
      arm = (double)node[n].position[0];
      if (steps(1, 0.005) != FB_OK) {
        return;
      }
      FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
      angular += k < 200 ? 0.25 * 0.5 * (arm + (double)node[n].position[0]) : 0.0;
      FBT_INT_EQ(fb_exact_momentum_eval(&exact, &p, &state), FB_OK);
      linear_off = fmax(linear_off, hypot((double)p.linear[0], (double)p.linear[1] - 0.25 * fmin(k + 1, 200)));
      angular_off = fmax(angular_off, fabs((double)p.angular[2] - angular));
    }
    FBT_BELOW(linear_off / 50.0, FBT_TOL(1e-11, 1e-3));
    FBT_BELOW(angular_off / angular, (fine ? 2.1e-3 : 7.5e-3) + FBT_TOL(0.0, 1e-3));
  }
}

/* E10.14, E11.20, E11.21: a free beam, bent and tumbling: linear and angular momentum about the origin, but for
   what the strains' own turn lacks. */
TEST(free_flight_keeps_momentum)
{
  for (int fine = 0; fine < 2; fine++) {
    const double stiffness[6] = {1e4, 4e3, 4e3, 80.0, 100.0, 100.0}, inertia[6] = {1.0, 1.0, 1.0, 2e-2, 1e-2, 1e-2};
    fb_exact_state still;
    fb_momentum a, b;
    double worst = 0.0, scale;
    beam(5.0, 8, stiffness, inertia);
    desc.root = FB_END_FREE;
    desc.iterations = 10;
    input.v[1] = FB_R(-2.0);
    input.w[0] = FB_R(0.3);
    input.w[1] = FB_R(0.4);
    input.w[2] = FB_R(1.0);
    start();
    FBT_INT_EQ(fb_exact_state_init(&exact, &still, &work, NULL), FB_OK); /* one at rest has none */
    FBT_INT_EQ(fb_exact_momentum_eval(&exact, &b, &still), FB_OK);
    FBT_NEAR_ABS(fb_vec3_dot(b.linear, b.linear) + fb_vec3_dot(b.angular, b.angular), 0.0, 0.0);
    FBT_INT_EQ(fb_exact_momentum_eval(&exact, &a, &state), FB_OK);
    FBT_NEAR_ABS(a.linear[1], 5.0 * (-2.0 + 2.5), FBT_TOL(1e-12, 1e-4));
    FBT_NEAR_REL(a.angular[2], 125.0 / 3.0 * 1.0 + 5e-2 - 2.0 * 12.5, FBT_TOL(1e-12, 1e-4));
    scale = sqrt((double)fb_vec3_dot(a.angular, a.angular));
    for (int k = 0; k < 200; k++) {
      if (steps(fine ? 10 : 5, fine ? 0.005 : 0.01) != FB_OK) {
        return;
      }
      FBT_INT_EQ(fb_exact_momentum_eval(&exact, &b, &state), FB_OK);
      worst = fmax(worst, fbt_difference(a.angular, b.angular, 3) / scale);
      worst = fmax(worst, fbt_difference(a.linear, b.linear, 3) / 5.0);
    }
    FBT_BELOW(worst, FBT_TOL(2e-6, 1e-4));
  }
}

/* E10.14, E10.28, E11.55: the beam of Simo and Vu-Quoc that is thrown off, 50 N s along x and turned about y and z, keeps
   its momentum to rounding and its energy to what the iteration leaves, on any mesh, at any step. */
TEST(a_beam_that_is_thrown_off_keeps_what_it_got)
{
  const double stiffness[6] = {1e4, 1e4, 1e4, 500.0, 500.0, 500.0}, inertia[6] = {1.0, 1.0, 1.0, 20.0, 10.0, 10.0};
  for (int run = 0; run < 3; run++) {
    const int n = run == 1 ? 20 : 10, each = run == 2 ? 2 : 1;
    const double dt = 0.01 / each;
    double energy;
    fb_momentum p, q;
    beam(10.0, n, stiffness, inertia);
    desc.root = FB_END_FREE;
    start();
    input.n_load = 1;
    for (int k = 0; k < 500 * each; k++) {
      const double t = (k + 0.5) * dt, T = t < 2.5 ? 80.0 * t : 400.0 - 80.0 * t;
      input.load[0].force[0] = (fb_real)(0.1 * T);
      input.load[0].torque[1] = (fb_real)(-0.5 * T);
      input.load[0].torque[2] = (fb_real)-T;
      if (steps(1, dt) != FB_OK) {
        return;
      }
    }
    input.n_load = 0;
    energy = total_energy();
    FBT_INT_EQ(fb_exact_momentum_eval(&exact, &p, &state), FB_OK);
    FBT_BELOW(hypot((double)p.linear[0] - 50.0, hypot((double)p.linear[1], (double)p.linear[2])), FBT_TOL(1e-11, 0.1));
    if (steps(500 * each, dt) != FB_OK) {
      return;
    }
    FBT_INT_EQ(fb_exact_momentum_eval(&exact, &q, &state), FB_OK);
    FBT_BELOW(fbt_difference(p.linear, q.linear, 3), FBT_TOL(1e-11, 0.1));
    FBT_NEAR_REL(total_energy(), energy, FBT_TOL(2e-9, 1e-2));
  }
}

/* E11.55, E11.33, E10.14: what forces of a fixed direction, on nodes and on the length, and moments that follow do to a
   free beam in coarse steps: its momentum is their impulse, and then its energy stays, at rest, at 250 m/s and in orbit. */
TEST(loads_give_a_free_beam_their_impulse)
{
  const double stiffness[6] = {1e4, 1e4, 1e4, 500.0, 500.0, 500.0}, inertia[6] = {1.0, 1.0, 1.0, 20.0, 10.0, 10.0};
  const double speed[3] = {0.0, 250.0, 7500.0};
  for (int run = 0; run < 3; run++) {
    const double v = speed[run], rounding = 40.0 * (double)FB_EPSILON * v * 10.5;
    double want[3], kept;
    fb_momentum p;
    beam(10.0, 10, stiffness, inertia);
    desc.root = FB_END_FREE;
    desc.n_lump = 1;
    desc.lump[0].node = 7;
    desc.lump[0].mass = FB_R(0.5);
    desc.lump[0].center[1] = FB_R(0.3);
    input.v[0] = (fb_real)v;
    input.w[2] = FB_R(0.5);
    start();
    FBT_INT_EQ(fb_exact_momentum_eval(&exact, &p, &state), FB_OK);
    for (int i = 0; i < 3; i++) {
      want[i] = (double)p.linear[i];
    }
    input.n_load = 2;
    input.load[0].node = 10;
    input.load[0].axes = FB_AXES_INERTIAL;
    input.load[0].force[1] = FB_R(4.0);
    input.load[0].force[2] = FB_R(-6.0);
    input.load[1].node = 0;
    input.load[1].axes = FB_AXES_NODE;
    input.load[1].torque[1] = FB_R(30.0);
    input.line[4].axes = FB_AXES_INERTIAL;
    input.line[4].force[0] = FB_R(3.0);
    if (steps(100, 0.02) != FB_OK) {
      return;
    }
    want[0] += 2.0 * 3.0;
    want[1] += 2.0 * 4.0;
    want[2] -= 2.0 * 6.0;
    FBT_INT_EQ(fb_exact_momentum_eval(&exact, &p, &state), FB_OK);
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(p.linear[i], want[i], FBT_TOL(1e-11, 2e-3) * 14.0 + rounding);
    }
    FBT_BELOW(0.5, fbt_largest(state.strain, 60) * 10.0);
    memset(&input, 0, sizeof input);
    kept = total_energy();
    if (steps(100, 0.02) != FB_OK) {
      return;
    }
    FBT_INT_EQ(fb_exact_momentum_eval(&exact, &p, &state), FB_OK);
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(p.linear[i], want[i], FBT_TOL(1e-11, 4e-3) * 14.0 + 2.0 * rounding);
    }
    FBT_NEAR_ABS(total_energy(), kept, FBT_TOL(2e-8, 1e-3) * 147.0 + 40.0 * (double)FB_EPSILON * 5.25 * v * v);
  }
}

/* E11.35: a free beam that bends and tumbles does so under uniform gravity as without, and its mass
   center falls by g t^2/2. */
TEST(free_fall_is_not_felt)
{
  static fb_exact_state without;
  static fb_exact_node still[FB_MAX_EXACT + 1];
  const double stiffness[6] = {1e4, 4e3, 4e3, 80.0, 100.0, 100.0}, inertia[6] = {1.0, 1.0, 1.0, 2e-2, 1e-2, 1e-2};
  static const double g[3] = {1.0, -9.81, 3.0};
  double before = 0.0, bend = 0.0;
  for (int falls = 0; falls < 2; falls++) {
    beam(5.0, 8, stiffness, inertia);
    desc.root = FB_END_FREE;
    for (int i = 0; i < 3 && falls; i++) {
      desc.gravity[i] = (fb_real)g[i];
    }
    input.v[1] = FB_R(-2.0);
    input.w[1] = FB_R(0.4);
    input.w[2] = FB_R(1.0);
    load_tip(FB_AXES_NODE, 0.0, 4.0, 2.0);
    start();
    if (steps(100, 0.01) != FB_OK) { /* pushed, then let go */
      return;
    }
    input.n_load = 0;
    before = total_energy();
    if (steps(100, 0.01) != FB_OK) {
      return;
    }
    without = falls ? without : state;
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, falls ? node : still, &state), FB_OK);
  }
  for (int k = 0; k < 8; k++) {
    bend = fmax(bend, fabs((double)without.strain[6 * k + 5]));
  }
  FBT_BELOW(0.01, bend);
  FBT_BELOW(fbt_difference(state.strain, without.strain, 48), FBT_TOL(1e-12, 2e-4) * bend);
  FBT_NEAR_REL(total_energy(), before, 5e-4); /* its own momentum drifts by that */
  for (int k = 0; k <= 8; k++) {
    fb_real v[2][3];
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(node[k].position[i] - still[k].position[i], 0.5 * g[i] * 4.0, FBT_TOL(1e-11, 1e-4));
    }
    for (int e = 0; e < 2; e++) { /* in the middle of the last step */
      fb_real R[9];
      fb_quat_to_mat33(R, e ? node[k].quat : still[k].quat);
      fb_mat33_mul_vec3(v[e], R, e ? node[k].velocity : still[k].velocity);
    }
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(v[1][i] - v[0][i], g[i] * 1.995, FBT_TOL(0.03, 0.03));
    }
  }
}

/* E10.13, E10.14: what moves as one has p v + L w = 2 T about the origin, in every shape: bent far, carried along by
   its base, under a load that follows the line, with a body on it. */
TEST(momenta_of_a_rigid_motion_are_those_of_its_energy)
{
  const double stiffness[6] = {300.0, 150.0, 200.0, 8.0, 5.0, 6.0}, inertia[6] = {1.3, 1.3, 1.3, 0.02, 0.03, 0.04};
  for (int with_lump = 0; with_lump < 2; with_lump++) {
    fb_momentum momentum;
    fb_energy energy;
    beam(1.0, 3, stiffness, inertia);
    desc.n_lump = with_lump;
    desc.lump[0].node = 2;
    desc.lump[0].mass = with_lump ? FB_R(0.2) : FB_R(0.0);
    desc.lump[0].center[1] = FB_R(0.1);
    for (int i = 0; i < 3; i++) {
      input.v[i] = (fb_real)(0.5 - 0.3 * i);
      input.w[i] = (fb_real)(0.4 * i - 0.7);
      input.line[1].force[i] = (fb_real)(6.0 - 2.0 * i);
      input.line[1].torque[i] = (fb_real)(i + 1.0);
    }
    input.line[1].axes = FB_AXES_NODE;
    load_tip(FB_AXES_NODE, 20.0, 5.0, -4.0);
    input.load[0].torque[2] = FB_R(9.0);
    settle();
    FBT_BELOW(0.5, fbt_largest(node[3].displacement, 3));
    FBT_BELOW(1e-3, fbt_largest(state.offset, 18));
    FBT_INT_EQ(fb_exact_momentum_eval(&exact, &momentum, &state), FB_OK);
    FBT_INT_EQ(fb_exact_energy_eval(&exact, &energy, &state), FB_OK);
    FBT_NEAR_REL(fb_vec3_dot(momentum.linear, input.v) + fb_vec3_dot(momentum.angular, input.w),
                 2.0 * (double)energy.kinetic, FBT_TOL(1e-10, 1e-4));
  }
}

/* E10.8, E11.21: a rigid beam that turns about a principal axis and flies across and along it, or tumbles, keeps
   momentum and angular momentum about a point of space in large steps, too: its center goes along a straight line. */
TEST(rigid_flight_is_straight)
{
  const double stiffness[6] = {0.0}, inertia[6] = {1.5, 1.5, 1.5, 0.3, 0.1, 0.2};
  for (int tumbles = 0; tumbles < 2; tumbles++) {
    fb_momentum a, b;
    beam(2.0, 3, stiffness, inertia);
    desc.root = FB_END_FREE;
    desc.iterations = 10;
    input.v[0] = FB_R(1.0);
    input.v[1] = FB_R(0.3);
    input.v[2] = FB_R(0.7);
    input.w[0] = tumbles ? FB_R(0.4) : FB_R(0.0);
    input.w[1] = tumbles ? FB_R(0.5) : FB_R(0.0);
    input.w[2] = FB_R(1.2);
    start();
    FBT_INT_EQ(fb_exact_momentum_eval(&exact, &a, &state), FB_OK);
    for (int k = 0; k < 20; k++) {
      if (steps(5, 0.1) != FB_OK) {
        return;
      }
      FBT_INT_EQ(fb_exact_momentum_eval(&exact, &b, &state), FB_OK);
      FBT_BELOW(fbt_difference(a.linear, b.linear, 3), FBT_TOL(1e-10, 1e-3));
      FBT_BELOW(fbt_difference(a.angular, b.angular, 3), FBT_TOL(1e-10, 1e-3));
    }
    FBT_BELOW(5.0, fbt_largest(state.base_position, 3));
  }
}

/* E10.6: rotary inertia counts, however little it is, down to the rounding of the largest inertia there is: a thread
   that turns about itself. Below that there is none, and no rate comes out of rounding. */
TEST(threads_turn_about_themselves)
{
  const double stiffness[6] = {1.0, 1.0, 1.0, 1.0, 1.0, 1.0}, rounding = FBT_TOL(1e-12, 1e-6);
  for (int less = 0; less < 2; less++) {
    const double i_z = 1e3, i_x = (less ? 0.6 : 1.6) * rounding * i_z;
    const double inertia[6] = {1.0, 1.0, 1.0, i_x, 1.0, i_z};
    fb_exact_element e;
    beam(1.0, 1, stiffness, inertia);
    input.w[0] = FB_R(2.0);
    start();
    FBT_INT_EQ(fb_exact_element_eval(&exact, &e, &state, 0), FB_OK);
    FBT_NEAR_ABS(e.angular_rate[0], less ? 0.0 : 2.0, FBT_TOL(1e-2, 0.2));
  }
}

/* E10.6: masses on one line have no inertia about it: a free beam without rotary inertia is refused however it stands, and
   taken with what round-off shows beside the square of its length, in the section or in one lump. */
TEST(free_lines_have_inertia_about_themselves)
{
  const double stiffness[6] = {1.0, 1.0, 1.0, 1.0, 1.0, 1.0}, little = 20.0 * (double)FB_EPSILON;
  fbt_seed(11);
  for (int t = 0; t < 60; t++) {
    const double inertia[6] = {1.0, 1.0, 1.0, t % 3 == 1 ? little : 0.0, 0.0, 0.0};
    beam(1.0, 1 + t % 7, stiffness, inertia);
    desc.root = FB_END_FREE;
    if (t % 3 == 2) {
      desc.n_lump = 1;
      desc.lump[0].node = 1;
      desc.lump[0].mass = FB_R(1.0);
      desc.lump[0].inertia[0] = desc.lump[0].inertia[1] = desc.lump[0].inertia[2] = (fb_real)little;
    }
    fbt_fill(desc.attitude, 4, 1.0);
    FBT_INT_EQ(fb_quat_normalize(desc.attitude), FB_OK);
    FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_OK);
    FBT_INT_EQ(fb_exact_state_init(&exact, &state, &work, &input), t % 3 ? FB_OK : FB_ERR_SINGULAR);
    FBT_INT_EQ(fb_exact_state_check(&exact, &state), t % 3 ? FB_OK : FB_ERR_VALUE);
  }
}

SUITE(exact_flight, RUN(free_lines_have_inertia_about_themselves), RUN(flight_at_any_speed_moves_as_rest_does),
      RUN(thrust_takes_the_frame_along), RUN_LONG(pushed_beams_take_up_the_impulse), RUN(threads_turn_about_themselves),
      RUN(free_flight_keeps_momentum), RUN_LONG(a_beam_that_is_thrown_off_keeps_what_it_got),
      RUN(loads_give_a_free_beam_their_impulse), RUN(free_fall_is_not_felt), RUN(rigid_flight_is_straight),
      RUN(momenta_of_a_rigid_motion_are_those_of_its_energy))
