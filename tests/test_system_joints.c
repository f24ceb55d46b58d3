/* >>system: joints: how each moves, what it carries, axes that are locked or driven, nodes that hold bodies. */
#include "system.h"

static fb_system_state kept, rate;

/* E9.11: a ball joint has one spring and one damper, the first ones, whose rest is zero: on a round body they give the
   rate -(k phi + c w)/J about all axes and the energy k phi^2/2, also as a loop. */
TEST(a_ball_joint_has_one_spring_and_one_damper)
{
  const double k = 3.0, c = 0.5, J = 0.7, phi[3] = {0.3, -0.5, 0.4};
  for (int form = 0; form < 3; form++) {
    fb_energy energy;
    fb_joint_desc *j;
    fresh();
    rigid(&model[0], 2.0, 0, 0, 0, J, J, J);
    hang(0, 0, form < 2 ? FB_JOINT_SPHERICAL : FB_JOINT_FREE, FB_GROUND, 0);
    j = form < 2 ? &desc.joint[0] : close_loop(FB_JOINT_SPHERICAL, FB_GROUND, 0, 0, 0);
    j->stiffness[0] = (fb_real)k;
    j->damping[0] = (fb_real)c;
    fbt_fill(j->rest, 3, 1.0);
    for (int i = 1; i < 3; i++) {
      j->stiffness[i] = j->damping[i] = FB_R(9.0);
    }
    turn(start[0].quat, phi[0], phi[1], phi[2]);
    fbt_fill(start[0].speed + (form < 2 ? 0 : 3), 3, 1.0);
    init(form < 2 ? form : (int)FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    FBT_INT_EQ(fb_system_energy_eval(&mechanism, model, &work, &energy, &state, NULL), FB_OK);
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(motion.motion[0].w_dot[i], -(k * phi[i] + c * (double)motion.motion[0].w[i]) / J,
                   FBT_TOL(1e-14, 1e-5));
    }
    FBT_NEAR_REL(energy.strain, 0.5 * k * 0.5, FBT_TOL(1e-14, 1e-5)); /* phi.phi is 0.5 */
  }
}

/* E9.8: a screw without pitch is a hinge, eliminated or as a loop. */
TEST(screws_without_pitch_are_hinges)
{
  static fb_system_motion first;
  for (int run = 0; run < 6; run++) {
    couple(run % 2 ? FB_JOINT_SCREW : FB_JOINT_REVOLUTE, 0, FB_AXIS_FREE);
    desc.joint[1].pitch = FB_R(0.0);
    init(run / 2);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    couple_steps(5, FBT_TOL(2e-4, 1e-3));
    motion_of(run ? &motion : &first, &state);
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, &input), FB_OK);
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
    init(run / 2);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &state, &work, 0, 0, FB_AXIS_LOCKED, &input), FB_OK);
    before = state.link[0];
    couple_steps(5, FBT_TOL(2e-4, 1e-3));
    FBT_BELOW(fbt_difference(state.link[0].x, before.x, 3), FBT_TOL(1e-14, 1e-6));
    FBT_BELOW(fbt_difference(state.link[0].quat, before.quat, 4), FBT_TOL(1e-14, 1e-6));
    motion_of(&motion, &state);
    FBT_NEAR_ABS(fbt_largest(motion.motion[0].v, 3), 0.0, 0.0);
    FBT_NEAR_ABS(fbt_largest(motion.motion[0].w, 3), 0.0, 0.0);
    FBT_TRUE(fabs((double)motion.joint[1].speed[0]) > 0.01);
  }
}

/* E9.16, latches: a hinge locked in motion, and freed again: momenta stay, energy goes, the hinge stands, also with
   joints as loops. */
TEST(a_latch_conserves_momentum)
{
  for (int form = 0; form < FORMS; form += AS_LOOPS) {
    fb_momentum before, after;
    double energy;
    fb_real at[3];
    tree(FB_EFFECTS_FULL, 0);
    for (int k = 1; k < 3; k++) {
      at[k] = start[k].value[0];
    }
    for (int k = 1; k < desc.n_body; k++) {
      memset(desc.joint[k].stiffness, 0, sizeof desc.joint[k].stiffness);
    }
    init(form);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &before, &state, &input), FB_OK);
    energy = energy_of(&state);
    for (int joint = 1; joint < 4; joint++) {
      const fb_link_state hub = state.link[0];
      FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &state, &work, joint_at[joint], 0, FB_AXIS_LOCKED, &input),
                 FB_OK);
      FBT_TRUE(form == AS_LOOPS ||
               memcmp(hub.p, state.link[0].p, sizeof hub.p) == 0); /* bits: often latched, none lost */
      FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &after, &state, &input), FB_OK);
      FBT_BELOW(fbt_difference(after.linear, before.linear, 3), FBT_TOL(1e-12, 1e-4));
      FBT_BELOW(fbt_difference(after.angular, before.angular, 3), FBT_TOL(1e-12, 1e-4));
      FBT_BELOW(energy_of(&state), energy);
      energy = energy_of(&state);
    }
    for (int k = 0; k < 100; k++) {
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(5e-4)), FB_OK);
    }
    motion_of(&motion, &state);
    for (int joint = 1; joint < 4; joint++) {
      FBT_NEAR_ABS(motion.joint[joint].speed[0], 0.0, FBT_TOL(1e-12, 1e-4));
      if (joint < 3) {
        FBT_NEAR_ABS(motion.joint[joint].value[0], at[joint], FBT_TOL(1e-10, 1e-4));
      }
      FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &state, &work, joint_at[joint], 0, FB_AXIS_FREE, &input), FB_OK);
    }
    FBT_NEAR_REL(energy_of(&state), energy, FBT_TOL(1e-8, 1e-3)); /* to free costs nothing */
    FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &after, &state, &input), FB_OK);
    FBT_BELOW(fbt_difference(after.angular, before.angular, 3), FBT_TOL(1e-10, 1e-3));
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
      input.drive[k].torque[i] = motor_of(k, i, fbt_random());
    }
  }
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, &input), FB_OK);
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
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, &input), FB_OK);
  for (int side = -2; side <= 2; side++) {
    static const double weight[5] = {1.0 / 12, -2.0 / 3, 0, 2.0 / 3, -1.0 / 12};
    fb_momentum at;
    moved(&kept, &state, &rate, side * h);
    FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &at, &kept, &input), FB_OK);
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
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, NULL, &input), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
  FBT_NEAR_ABS(motion.joint[0].force[0], -2.0 * 0.4 * spin * spin, FBT_TOL(1e-13, 1e-5));
  FBT_NEAR_ABS(motion.joint[0].force[2], 2.0 * g, FBT_TOL(1e-13, 1e-5));
  FBT_NEAR_ABS(motion.joint[0].torque[1], -2.0 * g * 0.4, FBT_TOL(1e-13, 1e-5));
  FBT_NEAR_ABS(motion.motion[0].reaction_torque[1], -2.0 * g * 0.4, FBT_TOL(1e-13, 1e-5));
  FBT_INT_EQ(fb_body_node_motion_eval(&model[0], &node, &motion.pose[0], &motion.motion[0], 1), FB_OK);
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

/* E9.1, E9.2, E9.3: hinges along an axis of both bodies, or against it, whose rotations leave out their zeros: bodies are
   turned about that axis, by quaternions, screws moved along it, from a place on the parent that is on the axis of the child,
   away from its origin; momenta of the bodies one by one give back the speeds. */
TEST(hinges_turn_about_axes_of_the_bodies)
{
  static const fb_joint_kind kinds[] = {FB_JOINT_REVOLUTE, FB_JOINT_CYLINDRICAL, FB_JOINT_SCREW};
  for (int run = 0; run < 18; run++) {
    const int k = run % 3, sign = run / 3 % 2 ? -1 : 1, kind = (int)kinds[run / 6];
    fb_real phi[3] = {0}, step[3] = {0}, by[4], quat[4], R[9], x[3];
    double most = 0.0;
    fresh();
    rigid(&model[0], 2.0, 0.3, 0.1, -0.2, 1, 2, 3);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    turn(start[0].quat, 0.1, 0.2, 0.3);
    for (int body = 1; body < 3; body++) {
      hang(body, 0, kinds[run / 6], body - 1, 0);
      desc.joint[body].axis[k] = (fb_real)(2 * body * sign);
      desc.joint[body].pitch = kind == (int)FB_JOINT_SCREW ? FB_R(0.25) : FB_R(0.0);
      desc.joint[body].position[(k + 1) % 3] = FB_R(0.5);
      desc.joint[body].child_position[k] = FB_R(-0.2);
      start[body].value[0] = FB_R(0.7);
      start[body].value[1] = FB_R(0.3);
      start[body].speed[0] = FB_R(0.4) * (fb_real)body;
    }
    start[0].speed[1] = start[0].speed[5] = FB_R(0.5);
    phi[k] = FB_R(0.7) * (fb_real)sign;
    step[k] = (kind == (int)FB_JOINT_SCREW         ? FB_R(0.175)
               : kind == (int)FB_JOINT_CYLINDRICAL ? FB_R(0.3)
                                                   : FB_R(0.0)) *
              (fb_real)sign;
    step[k] += FB_R(0.2);
    step[(k + 1) % 3] = FB_R(0.5);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(mechanism.joint[1].about, sign > 0 ? k + 1 : k + 4);
    FBT_INT_EQ(mechanism.joint[2].about, sign > 0 ? k + 1 : k + 4);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    fb_quat_from_rotvec(by, phi);
    for (int body = 1; body < 3; body++) {
      fb_quat_mul(quat, motion.pose[body - 1].quat, by);
      fb_quat_to_mat33(R, motion.pose[body - 1].quat);
      fb_mat33_mul_vec3(x, R, step);
      const double same =
          quat[0] * motion.pose[body].quat[0] + fb_vec3_dot(quat + 1, motion.pose[body].quat + 1) < 0 ? -1 : 1;
      for (int i = 0; i < 4; i++) {
        most = fmax(most, fabs((double)quat[i] - same * (double)motion.pose[body].quat[i]));
      }
      for (int i = 0; i < 3; i++) {
        const double apart = (double)motion.pose[body].rho[i] - (double)motion.pose[body - 1].rho[i];
        most = fmax(most, fabs(apart - (double)x[i]));
      }
      most = fmax(most, fabs((double)motion.joint[body].speed[0] - (double)start[body].speed[0]));
    }
    FBT_BELOW(most, FBT_TOL(1e-14, 2e-6));
  }
}

/* E9.1, E9.2, E9.7, E9.14: for every kind of joint the frame on the child sits on that of the parent, moved and turned
   by the coordinates as the header says, by quaternions. */
TEST(every_joint_moves_as_it_should)
{
  for (int kind = (int)FB_JOINT_RIGID; kind < (int)FB_JOINT_COUNT; kind++) {
    fb_real frame[4], child[4], rel[4], two[4], all[4], back[4];
    double origin[3], out[3], shift[3] = {0}, axis[3] = {0, 0, 1}, miss = 0.0, angle, slide;
    const joint_axes *axes = axes_of(kind);
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    angle = axes->angle < 0 ? 0.0 : (double)start[1].value[axes->angle];
    slide = axes->slide >= 0 ? (double)start[1].value[axes->slide] : kind == FB_JOINT_SCREW ? 0.25 * angle : 0.0;
    turn(rel, 0, 0, angle);
    turn(two, axes->tilt < 0 ? 0.0 : (double)start[1].value[axes->tilt], 0, 0);
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
    for (int form = 0; form < FORMS; form++) {
      init(form);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
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
  for (int form = 0; form < FORMS; form++) {
    init(form);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    FBT_INT_EQ(fb_body_node_motion_eval(&model[0], &tip, &motion.pose[0], &motion.motion[0], 1), FB_OK);
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    FBT_INT_EQ(fb_body_node_motion_eval(&model[0], &at, &motion.pose[0], &motion.motion[0], 1), FB_OK);
    FBT_NEAR_REL(way < 6 ? motion.motion[1].v[way % 3] : motion.motion[1].w[way % 3], 0.02, 1e-4);
    FBT_BELOW(fbt_difference(motion.pose[1].rho, at.position, 3), FBT_TOL(1e-14, 1e-6));
    FBT_BELOW(fbt_difference(motion.pose[1].quat, at.quat, 4), FBT_TOL(1e-14, 1e-6));
  }
}

/* E4.5: a body's attitude comes back from its matrix as the unit quaternion with w >= 0, whichever component is
   largest. */
TEST(attitudes_come_back_as_they_were)
{
  fresh();
  rigid(&model[0], 1.0, 0.1, 0, 0, 1.0, 1.0, 1.0);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  init(FB_METHOD_RECURSIVE);
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    for (int i = 0; i < 4; i++) {
      const fb_real sign = q[0] * motion.pose[0].quat[0] + fb_vec3_dot(q + 1, motion.pose[0].quat + 1);
      FBT_NEAR_ABS(motion.pose[0].quat[i], sign < FB_R(0.0) ? -q[i] : q[i], 8.0 * (double)FB_EPSILON);
    }
    FBT_TRUE(motion.pose[0].quat[0] >= FB_R(0.0));
  }
}

/* E9.7, E9.8: angles of loops go round: a hinge and the second axis of a universal joint driven through half a turn
   and a screw started far out, as loops, are where the tree has them. */
TEST(joints_of_loops_turn_all_the_way_round)
{
  fb_system_input middle;
  for (int form = 0; form < FORMS; form += AS_LOOPS) {
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
    init(form);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    middle = input;
    for (int k = 1; k <= 800; k++) { /* to 4.1 rad */
      const int a = joint_at[0], b = joint_at[2];
      middle.drive[a].value[0] = middle.drive[b].value[1] = (fb_real)(2.5 + 0.002 * (k - 0.5));
      input.drive[a].value[0] = input.drive[b].value[1] = (fb_real)(2.5 + 0.002 * k);
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &middle, &input, FB_R(0.001)), FB_OK);
    }
    motion_of(&motion, &state);
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
    FBT_INT_EQ(fb_system_init(&mechanism, &work, model, &desc, 2), locked == 3 ? FB_OK : FB_ERR_SINGULAR);
    if (locked == 3) {
      FBT_NEAR_REL(fb_system_rk4_limit(&mechanism, model, 0, 0), 2.785 / sqrt(1.05 * 200.0 / 0.5), FBT_TOL(1e-9, 1e-4));
    } else {
      FBT_INT_EQ(work.joint, 1);
    }
  }
}

/* E9.19: the reactions on a body are what its joints bear, about its origin in its axes: the own one's, and the
   opposite of those that hang on it; gravity lifts the energy of all by m g h. */
TEST(reactions_are_the_sum_of_joint_forces)
{
  const double g = 9.81;
  for (int run = 0; run < 2 * FORMS; run++) {
    const int straight = run % 2;
    fb_energy energy;
    double height = 0.0;
    couple(FB_JOINT_UNIVERSAL, 1, FB_AXIS_PRESCRIBED);
    body_desc.gravity[2] = -(fb_real)g;
    flexible(&model[0], 1, 1, 1, FB_EFFECTS_FULL | FB_EFFECT_GRAVITY);
    for (int k = 0; k < 2 && straight; k++) { /* undeformed the mass center is where the shape has it */
      fbt_fill(start[k].q, model[0].n, 0.0);
    }
    init(run / 2);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    motion_of(&motion, &state);
    reactions_are_of_joint(1, FBT_TOL(1e-11, 1e-3));
    FBT_INT_EQ(fb_system_energy_eval(&mechanism, model, &work, &energy, &state, &input), FB_OK);
    if (!straight) {
      continue;
    }
    for (int k = 0; k < 2; k++) {
      fb_real R[9], center[3];
      fb_quat_to_mat33(R, motion.pose[k].quat);
      fb_mat33_mul_vec3(center, R, shape.c);
      height += (double)(shape.mass * motion.pose[k].rho[2] + center[2]);
    }
    FBT_NEAR_ABS(energy.gravity, g * height, FBT_TOL(1e-12, 1e-4));
  }
}

/* A hinge with an axis of length `size` at an angle: the child's rotation matrix, which turns about the axis. */
static void hinged_by(fb_real R[9], const fb_real axis[3], const fb_real child_axis[3], double angle)
{
  fresh();
  rigid(&model[0], 2.0, 0, 0, 0, 1.0, 1.0, 1.0);
  hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
  memcpy(desc.joint[0].axis, axis, sizeof desc.joint[0].axis);
  memcpy(desc.joint[0].child_axis, child_axis, sizeof desc.joint[0].child_axis);
  start[0].value[0] = (fb_real)angle;
  start[0].speed[0] = FB_R(2.0);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
  fb_quat_to_mat33(R, motion.pose[0].quat);
}

/* E9.1: the child's axis lies on the parent's, and the child turns about it by the coordinate, of whatever length both
   are; without an axis of its own the child lies as the parent does. */
TEST(joints_turn_about_the_axes_that_they_are_given)
{
  static const fb_real upside[3] = {0, 0, -FB_R(1.0)}, none[3] = {0, 0, 0};
  fbt_seed(31);
  for (int run = 0; run < 20; run++) {
    fb_real a[3], b[3], R0[9], R[9], turn_quat[4], phi[3], turned[9], expected[9], on[3];
    double size[2];
    fbt_fill(a, 3, run % 3 ? 3.0 : 0.01);
    fbt_fill(b, 3, 1.0);
    memcpy(run % 5 == 1 ? a : b, run % 5 == 1 || run % 5 == 2 ? upside : run % 5 == 3 ? none : b, sizeof b);
    hinged_by(R0, a, b, 0.0);
    hinged_by(R, a, b, 0.7);
    size[0] = sqrt((double)fb_vec3_dot(a, a));
    size[1] = sqrt((double)fb_vec3_dot(b, b));
    for (int i = 0; i < 3; i++) {
      phi[i] = (fb_real)(0.7 * (double)a[i] / size[0]);
    }
    fb_quat_from_rotvec(turn_quat, phi);
    fb_quat_to_mat33(turned, turn_quat);
    fb_mat33_mul(expected, turned, R0);
    FBT_BELOW(fbt_difference(R, expected, 9), FBT_TOL(1e-14, 1e-5));
    fb_mat33_mul_vec3(on, R, run % 5 == 3 ? a : b); /* and the angular velocity, child axes to inertial ones */
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS((double)on[i] / (run % 5 == 3 ? size[0] : size[1]), (double)a[i] / size[0], FBT_TOL(1e-14, 1e-5));
    }
    fb_mat33_mul_vec3(on, R, motion.motion[0].w);
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(on[i], 2.0 * (double)a[i] / size[0], FBT_TOL(1e-13, 1e-5));
      FBT_TRUE(run % 5 != 3 || fabs((double)R0[4 * i] - 1.0) < FBT_TOL(1e-15, 1e-6));
    }
  }
}

/* E9.1: also axes that are all but opposite to z: the child's z axis lies on them to rounding, however small the
   angle. */
TEST(axes_near_the_opposite_of_z_are_met)
{
  static const fb_real z[3] = {0, 0, FB_R(1.0)};
  for (int k = 0; k < 8; k++) {
    const double tilt = pow(10.0, -1.0 - 2.0 * k);
    const fb_real axis[3] = {(fb_real)(0.6 * tilt), (fb_real)(-0.8 * tilt), -FB_R(1.0)};
    fb_real R[9], on[3];
    hinged_by(R, axis, z, 0.3);
    fb_mat33_mul_vec3(on, R, z);
    for (int i = 0; i < 2; i++) {
      FBT_NEAR_ABS(on[i], (double)axis[i] / sqrt(1.0 + tilt * tilt), FBT_TOL(1e-15, 5e-7));
    }
  }
}

/* Interface: an axis and an attitude on one side contradict each other; an axis is a number and not nothing. */
TEST(axes_that_are_none_are_refused)
{
  for (int run = 0; run < 6; run++) {
    fb_joint_desc *const j = &desc.joint[0];
    fresh();
    rigid(&model[0], 2.0, 0, 0, 0, 1.0, 1.0, 1.0);
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    (run % 2 ? j->child_axis : j->axis)[1] = run / 2 == 1 ? (fb_real)NAN : run / 2 == 2 ? FB_TINY / 2 : FB_R(1.0);
    (run % 2 ? j->child_attitude : j->attitude)[0] = run / 2 == 0 ? FB_R(1.0) : FB_R(0.0);
    FBT_INT_EQ(fb_system_init(&mechanism, &work, model, &desc, 1), run / 2 == 1 ? FB_ERR_NOT_FINITE : FB_ERR_VALUE);
  }
}

SUITE(system_joints, RUN(joints_turn_about_the_axes_that_they_are_given), RUN(axes_that_are_none_are_refused),
      RUN(axes_near_the_opposite_of_z_are_met), RUN(springs_and_dampers_balance_energy),
      RUN(joint_forces_carry_what_hangs_on_them), RUN(locked_axes_need_no_inertia),
      RUN(reactions_are_the_sum_of_joint_forces), RUN(every_joint_moves_as_it_should),
      RUN(hinges_turn_about_axes_of_the_bodies), RUN(joint_frames_may_be_half_a_turn_off),
      RUN(a_node_that_only_turns_carries_its_body), RUN(attitudes_come_back_as_they_were),
      RUN(nodes_that_move_in_one_way_carry_their_bodies), RUN(a_ball_joint_has_one_spring_and_one_damper),
      RUN(an_imu_reads_in_its_own_axes), RUN(screws_without_pitch_are_hinges), RUN(locked_free_bodies_stand),
      RUN(given_axes_have_no_momentum_rates), RUN(a_latch_conserves_momentum),
      RUN(joints_of_loops_turn_all_the_way_round))
