/* >>system: steps of systems: order, limits, iterations, sums. */
#include "system.h"

static fb_system_state kept;

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

/* A step of 0.1 s of the driven arm by either integrator (0 iterations: rk4); how far its joints then are from where
   2000 short steps lead, by how far those lead. */
static double driven_step(fb_status *status, double torque, int iterations, int allow)
{
  double off = 0.0, way = 0.0;
  driven_arm(torque);
  desc.allow_long_step = allow;
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  kept = state;
  *status = iterations ? fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, FB_R(0.1), iterations)
                       : fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(0.1));
  FBT_TRUE(*status == FB_OK || memcmp(&state, &kept, sizeof state) == 0);
  FBT_TRUE(*status != FB_ERR_CONVERGENCE || work.joint == 1 || work.joint == 2);
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

/* E11.24, E11.25: torques that lead an arm from rest to turn by radians within one step: Newton's iterations do not
   follow, and the step says so instead of giving what is off by a third; gentle ones go through, and are right. */
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

/* A rod that turns and bends on a sled, which runs along x at a speed: its modes after 0.4 s; 0 where a step is
   refused. */
static int on_sled(fb_real q[3], unsigned effects, double speed, double dt, int iterations)
{
  fb_status status = FB_OK;
  fresh();
  rigid(&model[0], 20.0, 0.0, 0.0, 0.0, 3.0, 3.0, 3.0);
  flexible(&model[1], 2, 1, 0, effects);
  hang(0, 0, FB_JOINT_PRISMATIC, FB_GROUND, 0);
  turn(desc.joint[0].attitude, 0.0, 0.5 * pi, 0.0);
  turn(desc.joint[0].child_attitude, 0.0, 0.5 * pi, 0.0);
  hang(1, 1, FB_JOINT_REVOLUTE, 0, 0);
  start[0].speed[0] = (fb_real)speed;
  start[1].speed[0] = FB_R(2.0);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
  input.drive[1].torque[0] = FB_R(1.0);
  for (int k = 0; k < (int)(0.4 / dt + 0.5) && status == FB_OK; k++) {
    status = fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, (fb_real)dt, iterations);
  }
  memcpy(q, state.link[1].q, 3 * sizeof *q);
  return status == FB_OK;
}

/* E11.24, E11.25: on a sled that runs at up to 300 m/s two iterations either bend the rod, of polynomials or a line, as
   thirty do or say that they do not: what bends is judged by itself, for beside the way of the sled it is nothing. */
TEST(a_fast_sled_does_not_hide_what_bends)
{
  for (int lines = 0; lines < 2; lines++) {
    const unsigned effects = lines ? FB_EFFECTS_LARGE : FB_EFFECTS_FULL;
    int taken = 0, refused = 0;
    for (int k = 0; k < 12; k++) {
      const double speed = 3.0 * pow(10.0, k % 3), dt = 1e-3 * pow(2.0, k / 3);
      fb_real q[3], fine[3];
      if (on_sled(q, effects, speed, dt, 2)) {
        FBT_TRUE(on_sled(fine, effects, speed, dt, 30));
        FBT_BELOW(fbt_difference(q, fine, 3), 0.02 * fbt_largest(fine, 3));
        taken++;
      } else {
        refused++;
      }
    }
    FBT_TRUE(taken > 2 && refused > 2);
  }
}

/* The modes of a stiff rod on the hinge of a hub that spins, driven to and fro, after 200 steps, and the largest of any of
   them on the way; 0 where a step is refused. */
static int on_spinning_hub(double q[3], double *most, double spin, double dt, int iterations)
{
  fb_status status = FB_OK;
  fresh();
  rigid(&model[0], 20.0, 0.1, 0.0, 0.0, 4.0, 3.0, 5.0);
  second = 0.05; /* 400 times as stiff as at 1 */
  body_desc.zeta[0] = body_desc.zeta[1] = body_desc.zeta[2] = FB_R(0.005);
  flexible(&model[1], 2, 1, 0, FB_EFFECTS_FULL | FB_EFFECT_DAMPING);
  second = 1.0;
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  hang(1, 1, FB_JOINT_REVOLUTE, 0, 1);
  desc.joint[1].stiffness[0] = FB_R(3.0);
  desc.joint[1].damping[0] = FB_R(0.05);
  start[0].speed[3] = FB_R(0.1);
  start[0].speed[4] = FB_R(0.05);
  start[0].speed[5] = (fb_real)spin;
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
  *most = 0.0;
  for (int k = 0; k < 200 && status == FB_OK; k++) {
    input.drive[1].torque[0] = (fb_real)(0.01 * sin(3.0 * k * dt));
    status = fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, (fb_real)dt, iterations);
    for (int a = 0; a < 3; a++) {
      q[a] = (double)state.link[1].q[a];
      *most = fmax(*most, fabs(q[a]));
    }
  }
  return status == FB_OK;
}

/* E11.25: stiff modes that follow what moves them come to rest again and again, where a tenth of their increment is
   nothing. Two iterations take all steps and lead where thirty do. */
TEST(stiff_modes_that_hardly_move_are_no_failure)
{
  static const double spins[3] = {0.0, 1.0, 3.0}, steps[3] = {0.01, 0.005, 0.002};
  for (int k = 0; k < 9; k++) {
    const double spin = spins[k % 3], dt = steps[k / 3];
    double q[3], fine[3], most;
    FBT_TRUE(on_spinning_hub(q, &most, spin, dt, 2));
    FBT_TRUE(on_spinning_hub(fine, &most, spin, dt, 30));
    for (int a = 0; a < 3; a++) {
      FBT_NEAR_ABS(q[a], fine[a], FBT_TOL(1e-3, 1e-2) * most);
    }
  }
}

/* The modes of a stiff rod that tumbles on a ball of a hub, after 5 steps, and the largest of any of them on the way; far
   away a mass on a spring flies to and fro. 0 where a step is refused. */
static int tumbling(double q[3], double *most, double away, double speed, double dt, int iterations)
{
  fb_status status = FB_OK;
  fresh();
  rigid(&model[0], 20.0, 0.1, 0.0, 0.0, 4.0, 3.0, 5.0);
  second = 0.03;
  flexible(&model[1], 2, 1, 0, FB_EFFECTS_FULL);
  second = 1.0;
  rigid(&model[2], 1.0, 0.1, 0.0, 0.0, 0.1, 0.1, 0.1);
  hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
  hang(1, 1, FB_JOINT_SPHERICAL, 0, 0);
  hang(2, 2, FB_JOINT_PRISMATIC, FB_GROUND, 0);
  turn(desc.joint[1].attitude, 0.5, 0.3, -0.7);
  desc.joint[2].stiffness[0] = FB_R(1000.0);
  desc.allow_long_step = 1;
  start[0].speed[0] = start[1].speed[0] = (fb_real)speed;
  start[1].speed[1] = (fb_real)(-0.7 * speed);
  start[1].speed[2] = (fb_real)(0.4 * speed);
  start[2].value[0] = (fb_real)away;
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
  *most = 0.0;
  for (int k = 0; k < 5 && status == FB_OK; k++) {
    status = fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, (fb_real)dt, iterations);
    for (int a = 0; a < 3; a++) {
      q[a] = (double)state.link[1].q[a];
      *most = fmax(*most, fabs(q[a]));
    }
  }
  return status == FB_OK;
}

/* E11.25: what moves far beside a rod that bends, and converges at once, does not count for the rod: two iterations bend it
   as thirty do or say that they do not. */
TEST(what_moves_far_does_not_hide_what_bends)
{
  static const double away[4] = {0.0, 1.0, 30.0, 1e4}, speeds[3] = {0.3, 1.0, 3.0};
  int taken = 0, refused = 0;
  for (int k = 0; k < 48; k++) {
    const double off = away[k % 4], speed = speeds[k / 4 % 3], dt = 0.01 * pow(2.0, k / 12);
    double q[3], fine[3], most;
    if (tumbling(q, &most, off, speed, dt, 2)) {
      FBT_TRUE(tumbling(fine, &most, off, speed, dt, 30));
      for (int a = 0; a < 3; a++) {
        FBT_NEAR_ABS(q[a], fine[a], 0.02 * most + 1e-9);
      }
      taken++;
    } else {
      refused++;
    }
  }
  FBT_TRUE(taken > 4 && refused > 4);
}

/* E11.27, E11.28: a thin tube, 10 m long, as the only body of a system, tumbling with a little spin about its axis, in
   steps of a tenth of the limit: spin about the axis and energy stay, down to inertias of 1e-8 (single 1e-4) to one,
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    before = energy_of(&state);
    dt = 0.1 * (double)fb_system_rk4_limit(&mechanism, model, FB_R(0.1), FB_R(0.0));
    for (int step = 0; step < 2000; step++) {
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, (fb_real)dt), FB_OK);
    }
    FBT_NEAR_REL(energy_of(&state), before, FBT_TOL(1e-12, 1e-4));
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    FBT_DOUBLE_ONLY("16 roundings times 1e4 are a fourth of the spin")
    {
      FBT_NEAR_REL(motion.motion[0].w[0], 0.01, 1e-4);
    }
  }
}

/* E11.26: a step in which a body comes to turn by radians is refused by either integrator, though nothing turns at its
   start and no spring bounds it; half of that goes through, and is right. */
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

/* E11.12 to E11.14, E9.13: halving the step divides the error by 2^order, with all joints, eliminated or as loops, motors,
   loads and prescribed axes; the reference is rk4 with a much shorter step. */
TEST(systems_converge_with_the_order_of_the_integrator)
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
      init(run == 1 ? AS_LOOPS : (int)FB_METHOD_RECURSIVE);
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

/* E11.14: between the ends of a step inputs are linear: what they give a round body at rest is the mean of both times
   dt, forces momentum, torques and motors spin, prescribed rates path and turn, each in all its components. */
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
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

/* got is after to a thirtieth of the way from before, but for rounding. */
static void nearly(const fb_real *got, const fb_real *after, const fb_real *before, int n)
{
  const double rounding = FBT_TOL(1e-13, 1e-6) * fbt_largest(after, n) + 1e-30;
  FBT_BELOW(fbt_difference(got, after, n), 0.03 * fbt_difference(after, before, n) + rounding);
}

/* E9.4, E9.6, E11.13: the matrix of an implicit step is that of the linear system, with springs and dampers of joints
   and of modes, and locked axes: about the undeformed shape one iteration of a step of many periods is as good as
   twenty. */
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
    init(run / 2 % 2);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
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

/* E11.12: the limit is that of the undeformed linkage at zero coordinates: a body on a sprung ball joint, its center c
   further out, on one that turns freely about z, det(K - omega^2 M) = 0 with M of the two angles about z. */
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
   about its hinge; with joints as loops it is (c, k) (1/J_0 + 1/J_1) of two that turn freely, and the spring to the
   ground. */
TEST(what_is_prescribed_has_no_limit)
{
  const double k[2] = {700.0, 300.0}, c[2] = {3.0, 2.0}, J[2] = {0.4, 0.1}, m = 2.0, out = 0.3;
  for (int run = 0; run < 6; run++) {
    const int given = run % 2; /* a hinge, or a free body */
    const int form = run / 2;
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
    if (form == AS_LOOPS) {
      const double apart = given ? 1.0 / J[1] : 1.0 / J[0] + 1.0 / J[1], ground = given ? 0.0 : 1.0 / J[0];
      stiff = k[1] * apart + k[0] * ground;
      damped = c[1] * apart + c[0] * ground;
    }
    g = 0.5 * damped;
    init(form);
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
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
  kept = state;
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, FB_R(1.05) * limit), FB_ERR_STEP);
  FBT_TRUE(memcmp(&kept, &state, sizeof state) == 0);
  for (int step = 0; step < 1000; step++) {
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, FB_R(0.9) * limit), FB_OK);
  }
  FBT_BELOW(fabs((double)state.link[0].x[0]), 0.001);
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, -limit), FB_ERR_VALUE);
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

/* E11.13, E8.29: about a beam that a load at its tip pulls, bent and straight, the matrix of a step has the stiffness
   of that state: one iteration of a step of half a period is as good as twenty. */
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, NULL, NULL), FB_OK);
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
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
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

/* E11.13, E8.29: Newton's iterations of a step with the tangent of the nonlinear strain, bent in both planes or one:
   the second leaves less than a two hundredth, a fiftieth of what the first leaves; where that tangent is in the matrix
   alone it was a sixth. */
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
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &whole, &work, start, NULL), FB_OK);
    for (int step = 0; step < 4000; step++) {
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &whole, &work, NULL, NULL, NULL, FB_R(0.0005)), FB_OK);
    }
    desc.joint[1].mode[0] = FB_AXIS_FREE;
    desc.joint[1].stiffness[0] = (fb_real)FBT_TOL(1e10, 1e6);
    desc.joint[1].damping[0] = run ? FB_R(1e4) : 0;
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, (fb_real)dt), FB_ERR_STEP);
    for (int step = 0; step < 400; step++) {
      FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, NULL, NULL, (fb_real)dt, 0), FB_OK);
    }
    FBT_NEAR_ABS(state.link[0].x[0], whole.link[0].x[0], FBT_TOL(1e-3, 2e-3));
    FBT_BELOW(fabs((double)state.link[1].x[0]), FBT_TOL(1e-6, 1e-4));
  }
}

/* E11.12: springs and dampers of joints of loops, each against what its axis moves: a ball joint at the mass center
   k (1/J_1 + 1/J_2 + 1/J_3), a cylindrical one k_0/J_3 + k_1 (1/m + r^2/J), its axis r beside the center. */
TEST(limits_of_loops_are_in_closed_form)
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
    init(AS_LOOPS);
    FBT_NEAR_REL(fb_system_rk4_limit(&mechanism, model, 0, 0), 2.785 / (g + sqrt(g * g + stiff)), FBT_TOL(1e-9, 1e-4));
  }
}

SUITE(system_steps, RUN(inputs_are_linear_between_the_ends_of_a_step),
      RUN(the_limit_finds_neighbors_against_each_other), RUN(what_is_prescribed_has_no_limit),
      RUN(limits_of_loops_are_in_closed_form), RUN(system_steps_beyond_the_limit_are_refused),
      RUN(the_limit_of_a_linkage_is_in_closed_form), RUN(a_stretching_rod_carries_its_neighbor),
      RUN(stiff_joints_take_long_steps), RUN(one_iteration_is_enough_for_a_linear_system),
      RUN(the_limit_finds_the_fastest_body), RUN(strained_bodies_converge_in_a_system),
      RUN(one_iteration_is_enough_about_a_stretched_beam), RUN(systems_converge_with_the_order_of_the_integrator),
      RUN(steps_that_have_not_converged_say_so), RUN(a_fast_sled_does_not_hide_what_bends),
      RUN(stiff_modes_that_hardly_move_are_no_failure), RUN(what_moves_far_does_not_hide_what_bends),
      RUN(steps_that_turn_too_far_are_refused), RUN(thin_tubes_keep_calm), RUN(systems_lose_nothing_by_short_steps))
