/* >>system: joints that close loops: where and how they close, their springs, what contradicts itself. */
#include "system.h"

static fb_system_analyse_work analyse_work;
static fb_spectrum spectrum;
static fb_system_state kept;

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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
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

/* E12.11: a linkage with a spring at its crank, in any plane, swings with k/(2 T) of a crank that turns with 1 rad/s,
   and with as many periods a second whatever the unit of length; redundant rows come first or last. */
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_spectrum_solve(&mechanism, model, &analyse_work, &spectrum, &state, NULL), FB_OK);
    start[0].speed[0] = FB_R(1.0);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_energy_eval(&mechanism, model, &work, &energy, &state, NULL), FB_OK);
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
    const int form = run % 3, only = run / 3; /* all, springs, dampers, motors */
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
    init(form);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    FBT_INT_EQ(fb_system_energy_eval(&mechanism, model, &work, &energy, &state, &input), FB_OK);
    for (int i = 0; i < 2; i++) {
      FBT_NEAR_REL(motion.motion[i].w_dot[2], torque[i] / inertia[i], FBT_TOL(1e-12, 1e-5));
    }
    FBT_NEAR_REL(motion.power, power, FBT_TOL(1e-12, 1e-5));
    FBT_NEAR_REL(energy.strain, strain, FBT_TOL(1e-12, 1e-5));
  }
}

/* E9.17: a loop whose axis is prescribed closes where it is told to be, from a start aside, whichever way it runs. */
TEST(a_prescribed_loop_closes_where_it_is_told)
{
  for (int kind = (int)FB_JOINT_REVOLUTE; kind < (int)FB_JOINT_COUNT; kind++) {
    const int axis = axes_of(kind)->count - 1;
    for (int form = 0; form < (kind == FB_JOINT_SPHERICAL ? 0 : kind == FB_JOINT_UNIVERSAL ? 1 : 2); form++) {
      couple((fb_joint_kind)kind, axis, FB_AXIS_PRESCRIBED);
      init(FB_METHOD_RECURSIVE);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
      couple_by_a_loop(&motion, form);
      input.drive[2].value[axis] += FB_R(0.05);
      init(FB_METHOD_RECURSIVE);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
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

/* E9.17: from a rough guess joints move and modes do not, however soft, and what the bodies carry stays: linear and
   angular momentum of two free bodies are those before the loop took hold. */
TEST(a_loop_that_closes_keeps_shape_and_momentum)
{
  for (int run = 0; run < 14; run++) {
    static fb_system_desc with;
    const int kind = (int)FB_JOINT_RIGID + run / 2, soft = run % 2;
    fb_momentum before, after;
    couple((fb_joint_kind)kind, 0, FB_AXIS_FREE);
    for (int a = 0; a < model[0].n && soft; a++) {
      model[0].K.diagonal[a] *= FB_R(1e-10);
    }
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    couple_by_a_loop(&motion, 0);
    start[1].value[0] += FB_R(0.05);
    start[1].value[1] -= FB_R(0.04);
    with = desc;
    desc.n_loop = 0;
    memset(desc.loop, 0, sizeof desc.loop);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &before, &state, NULL), FB_OK);
    desc = with;
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &after, &state, NULL), FB_OK);
    FBT_BELOW(fbt_difference(after.linear, before.linear, 3), FBT_TOL(1e-12, 1e-5));
    FBT_BELOW(fbt_difference(after.angular, before.angular, 3), FBT_TOL(1e-12, 1e-4));
    for (int k = 0; k < 2; k++) {
      FBT_BELOW(fbt_difference(state.link[k].q, start[k].q, model[0].n), 1e-6);
    }
  }
}

/* E9.17: an arm of two links that ends 3 mm short of the tip of a cantilever: joints alone straighten it and cannot close
   the loop, the cantilever bends to it. The posture is near to what was asked, the elbow no more bent than there, and
   follows what was asked steadily. */
TEST(a_loop_that_joints_cannot_close_bends_a_body_to_it)
{
  double elbow[3];
  for (int run = 0; run < 3; run++) {
    double squares = 0.0;
    fresh();
    rigid(&model[0], 1.0, 0.5, 0, 0, 0.1, 0.2, 0.2);
    flexible(&model[1], 2, 0, 0, FB_EFFECTS_FULL);
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    hang(1, 0, FB_JOINT_REVOLUTE, 0, 1);
    hang(2, 1, FB_JOINT_RIGID, FB_GROUND, 0);
    desc.joint[2].position[0] = FB_R(2.003);
    desc.joint[2].position[1] = -FB_R(1.0);
    turn(desc.joint[2].attitude, 0, 0, pi / 2);
    close_loop(FB_JOINT_SPHERICAL, 2, 1, 1, 1);
    start[0].value[0] = FB_R(0.025);
    start[1].value[0] = -FB_R(0.05) + (fb_real)(run - 1) * FB_R(1e-5);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    for (int a = 0; a < model[1].n; a++) {
      squares += (double)(state.link[2].q[a] * state.link[2].q[a]);
    }
    elbow[run] = (double)state.link[1].x[0];
    FBT_BELOW(fabs(elbow[run]), 0.051);
    FBT_BELOW(fabs((double)state.link[0].x[0]), 0.026);
    FBT_TRUE(squares > 0.0);
  }
  FBT_BELOW(fabs(elbow[2] - elbow[0]), 1e-4);
}

/* E9.17: hinges about axes through one point, whose loop has two rows of five that count, and a chain of three bars closed
   to the ground, in meters, millimeters and kilometers, close from guesses all around. */
TEST(loops_close_from_rough_guesses)
{
  const double pointed[4][3] = {
      {0.0, 0.0, 1.0}, {0.56464, 0.0, 0.82534}, {0.56464, 0.47943, 0.82534}, {0.0, 0.64422, 0.76484}};
  for (int run = 0; run < 4; run++) {
    const double unit = run < 2 ? 1.0 : run < 3 ? 1e-3 : 1e3, bar[3] = {0.4, 1.0, 0.8};
    int refused = 0;
    for (int guess = 0; guess < 512; guess++) {
      fresh();
      for (int k = 0; k < 3; k++) {
        const double L = unit * bar[k], J = 0.05 * L * L;
        rigid(&model[k], 1.0, 0.5 * L, 0, 0, J, J, J);
        hang(k, k, FB_JOINT_REVOLUTE, k - 1, k > 0 && run > 0);
        start[k].value[0] = (fb_real)((guess >> (3 * k) & 7) * (run ? pi / 4.0 : 0.05) - (run ? 0.0 : 0.175));
      }
      start[2].value[0] += run ? FB_R(0.1) : FB_R(0.0);
      close_loop(FB_JOINT_REVOLUTE, FB_GROUND, 0, 2, run > 0)->position[0] = (fb_real)(run ? 1.1 * unit : 0.0);
      for (int k = 0; k < 4 && run == 0; k++) {
        fb_joint_desc *const j = k < 3 ? &desc.joint[k] : &desc.loop[0];
        for (int i = 0; i < 3; i++) {
          j->axis[i] = (fb_real)pointed[k][i];
          j->position[i] = j->child_position[i] = k < 3 ? FB_R(0.0) : (fb_real)(0.7 * pointed[k][i]);
        }
      }
      init(FB_METHOD_RECURSIVE);
      refused += fb_system_state_init(&mechanism, model, &state, &work, start, NULL) != FB_OK;
    }
    FBT_INT_EQ(refused, 0);
  }
}

/* E9.17: a four-bar whose coupler bends closes by its joints from guesses all around, though some steps let modes go on
   the way there: 4 of 203 stay bent by a millimeter or two; 82 of 198 where joints are not tried once more. */
TEST(what_joints_can_close_is_not_bent)
{
  int closed = 0, bent = 0;
  for (int guess = 0; guess < 216; guess++) {
    fresh();
    rigid(&model[0], 1.0, 0.2, 0, 0, 0.05, 0.05, 0.05);
    rigid(&model[2], 1.0, 0.4, 0, 0, 0.05, 0.05, 0.05);
    flexible(&model[1], 2, 2, 0, FB_EFFECTS_FULL);
    for (int k = 0; k < 3; k++) {
      hang(k, k, FB_JOINT_REVOLUTE, k == 1 ? 0 : FB_GROUND, k == 1);
    }
    desc.joint[2].position[0] = FB_R(1.1);
    close_loop(FB_JOINT_REVOLUTE, 1, 1, 2, 1);
    start[0].value[0] = (fb_real)(guess % 6 * pi / 3.0);
    start[1].value[0] = (fb_real)(guess / 6 % 6 * pi / 3.0);
    start[2].value[0] = (fb_real)(guess / 36 * pi / 3.0) + FB_R(0.1);
    init(FB_METHOD_RECURSIVE);
    if (fb_system_state_init(&mechanism, model, &state, &work, start, NULL) == FB_OK) {
      closed++;
      bent += fbt_largest(state.link[1].q, model[1].n) > 1e-4;
    }
  }
  FBT_TRUE(closed > 200);
  FBT_TRUE(bent < 6);
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_NEAR_ABS(state.link[0].x[2], 5.0, FBT_TOL(1e-12, 1e-5));
    FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &state, &work, 1, axis, FB_AXIS_LOCKED, &input), FB_OK);
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
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
  for (int kind = (int)FB_JOINT_RIGID; kind < (int)FB_JOINT_COUNT; kind++) {
    const int ball = kind == FB_JOINT_SPHERICAL;
    const int slides = !ball && axes_of(kind)->angle < 0;
    for (int axis = 0; axis < 3; axis++) {
      const int turns = ball || (axes_of(kind)->tilt >= 0 && axis != 1) || (axis == 2 && !slides);
      fresh();
      rigid(&model[0], 1.0, 0.2, 0, 0, 0.1, 0.1, 0.1);
      hang(0, 0, FB_JOINT_SPHERICAL, FB_GROUND, 0);
      close_loop((fb_joint_kind)kind, FB_GROUND, 0, 0, 0);
      turn(start[0].quat, axis == 0 ? 3.0 : 0.0, axis == 1 ? 3.0 : 0.0, axis == 2 ? 3.0 : 0.0);
      init(FB_METHOD_RECURSIVE);
      if (axes_of(kind)->tilt < 0 || axis != 1) {
        FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL),
                   turns ? FB_OK : FB_ERR_CONTRADICTION);
      }
    }
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL),
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
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  kept = state;
  input.drive[0].rate[0] = FB_R(0.01);
  input.drive[2].rate[0] = -FB_R(0.01);
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(0.001)),
             FB_ERR_CONTRADICTION);
  FBT_INT_EQ(work.joint, 3);
  FBT_TRUE(memcmp(&kept, &state, sizeof state) == 0);
  fourbar(0.4, 1.0, 0.8, 5.0, FB_JOINT_REVOLUTE); /* too far apart to close */
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_ERR_CONTRADICTION);
  FBT_INT_EQ(work.joint, 3);
  for (int method = 0; method < 2; method++) { /* a massless body at the end of a chain */
    fresh();
    rigid(&model[0], 1.0, 0.5, 0, 0, 0.1, 0.1, 0.1);
    rigid(&model[1], 0, 0, 0, 0, 0, 0, 0);
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    hang(1, 1, FB_JOINT_REVOLUTE, 0, 1);
    desc.method = (fb_method)method;
    FBT_INT_EQ(fb_system_init(&mechanism, &work, model, &desc, 2), FB_ERR_SINGULAR);
    FBT_INT_EQ(work.joint, 1);
  }
}

/* E9.9, E9.10: two links on hinges of the ground whose ends a hinge pins to each other stand still: two constraint rows
   hold them, the other three are left out, and what these miss is the round-off of the impulses that stop the links from
   any speed, also of one that turned at 1000 rad/s. That a motor elsewhere is prescribed makes it no contradiction, with either
   method and in any attitude. */
TEST(loops_that_stand_still_contradict_no_prescribed_axis)
{
  for (int run = 0; run < 60; run++) {
    const double x = 0.9, across = 0.6, speed = run % 2 ? 1.0 : FBT_TOL(1e3, 10.0);
    fresh();
    rigid(&model[0], 1.0, 0.4, 0, 0, 0.1, 0.1, 0.1);
    rigid(&model[1], 0.7, 0.3, 0, 0, 0.1, 0.1, 0.1);
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    hang(1, 1, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    hang(2, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    desc.joint[1].position[0] = (fb_real)x;
    desc.joint[2].mode[0] = FB_AXIS_PRESCRIBED;
    fbt_seed((unsigned)run + 1);
    tilt_ground(2.0 * fbt_random(), 2.0 * fbt_random(), 2.0 * fbt_random());
    for (int side = 0; side < 2; side++) { /* the pin at (0.45, 0.6): out along each link */
      const double angle = side ? pi - atan2(across, 0.5 * x) : atan2(across, 0.5 * x);
      start[side].value[0] = (fb_real)angle;
      start[side].speed[0] = (fb_real)speed;
    }
    close_loop(FB_JOINT_REVOLUTE, 0, 0, 1, 0);
    desc.loop[0].position[0] = desc.loop[0].child_position[0] = (fb_real)hypot(0.5 * x, across);
    input.drive[2].rate[0] = FB_R(0.1);
    init(run / 2 % 2);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    FBT_BELOW(fabs((double)motion.motion[0].w[2]) + fabs((double)motion.motion[1].w[2]), FBT_TOL(1e-12, 1e-5) * speed);
    input.drive[2].value[0] = FB_R(0.0001);
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(0.001)), FB_OK);
  }
}

/* E9.10: crank and rocker of a four-bar are both prescribed, at rates that fit to round-off: taken, with either method and at
   any angle of the crank. A rocker that is faster by a millionth contradicts the loop, and so do crank and rod, where the
   tree alone gives every speed. */
TEST(what_contradicts_a_loop_by_a_millionth_is_refused)
{
  const double a = 0.4, b = 1.0, c = 0.8, d = 1.1, spin = 3.0, much = FBT_TOL(1e-6, 1e-2);
  for (int run = 0; run < 48; run++) {
    const int other = run % 2 ? 1 : 2; /* rod or rocker */
    const double crank = 0.35 + 0.5 * (run / 4), rocker = rocker_angle(a, b, c, d, crank);
    const double rod = atan2(c * sin(rocker) - a * sin(crank), d + c * cos(rocker) - a * cos(crank));
    const double rod_rate = spin * a * sin(rocker - crank) / (b * sin(rod - rocker));
    const double rate = other == 1 ? rod_rate - spin : spin * a * sin(rod - crank) / (c * sin(rod - rocker));
    fourbar(a, b, c, d, FB_JOINT_REVOLUTE);
    start[0].value[0] = input.drive[0].value[0] = (fb_real)crank;
    start[1].value[0] = input.drive[1].value[0] = (fb_real)(rod - crank);
    start[2].value[0] = input.drive[2].value[0] = (fb_real)rocker;
    desc.joint[0].mode[0] = desc.joint[other].mode[0] = FB_AXIS_PRESCRIBED;
    input.drive[0].rate[0] = (fb_real)spin;
    for (int more = -1; more <= 1; more++) {
      const fb_status status = more ? FB_ERR_CONTRADICTION : FB_OK;
      input.drive[other].rate[0] = (fb_real)(rate + more * much * spin);
      init(run / 2 % 2);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), status);
    }
    input.drive[other].rate[0] = (fb_real)rate;
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    input.drive[other].rate[0] = (fb_real)(rate + much * spin);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_ERR_CONTRADICTION);
  }
}

/* E9.9: three links that are almost in a line, a few thousandths (single precision some tenths) of a radian from the singular
   position, with masses of 1 to 400 (single precision 1 to 4): both rows of the plane hold, whatever moves what is light or heavy. The pin's two ends
   move alike, from any speeds. */
TEST(masses_do_not_make_rows_dependent)
{
  for (int run = 0; run < 200; run++) {
    const double bent = FBT_TOL(1e-3, 0.2), base = 2.2;
    double angle[2], rate[3], pin[2], v[2];
    fresh();
    fbt_seed((unsigned)run + 1);
    for (int k = 0; k < 3; k++) {
      rigid(&model[k], pow(FBT_TOL(20.0, 2.0), 1.0 + fbt_random()), 0.3 * fbt_random(), 0.1 * fbt_random(), 0, 0.1, 0.1,
            0.1);
      hang(k, k, FB_JOINT_REVOLUTE, k == 1 ? 0 : FB_GROUND, 0);
      start[k].speed[0] = (fb_real)fbt_random();
    }
    desc.joint[1].position[0] = FB_R(1.0);
    desc.joint[2].position[0] = (fb_real)base;
    angle[0] = bent * (1.0 + 0.5 * fbt_random());
    angle[1] = -bent * (1.0 + 0.5 * fbt_random()); /* of the second link from the x axis */
    start[0].value[0] = (fb_real)angle[0];
    start[1].value[0] = (fb_real)(angle[1] - angle[0]);
    pin[0] = cos(angle[0]) + cos(angle[1]);
    pin[1] = sin(angle[0]) + sin(angle[1]);
    close_loop(FB_JOINT_REVOLUTE, 1, 0, 2, 0);
    desc.loop[0].position[0] = FB_R(1.0);
    desc.loop[0].child_position[0] = (fb_real)(pin[0] - base);
    desc.loop[0].child_position[1] = (fb_real)pin[1];
    init(run % 2);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    for (int k = 0; k < 3; k++) {
      rate[k] = (double)motion.motion[k].w[2];
    }
    v[0] = -rate[0] * sin(angle[0]) - rate[1] * sin(angle[1]);
    v[1] = rate[0] * cos(angle[0]) + rate[1] * cos(angle[1]);
    FBT_NEAR_ABS(v[0], -rate[2] * pin[1], FBT_TOL(1e-9, 1e-4));
    FBT_NEAR_ABS(v[1], rate[2] * (pin[0] - base), FBT_TOL(1e-9, 1e-4));
  }
}

/* E9.9, E9.17: a loop that locks the one hinge between two bodies asks that for the same six times, by forces and by torques;
   the largest row of either is as good. It is chosen by its order where round-off would choose: however far the loops are
   open at first, they close at the same place with the recursion and with a dense LU. */
TEST(methods_choose_the_same_of_equal_rows)
{
  for (int run = 0; run < 60; run++) {
    fb_system_state other;
    fb_joint_desc *loop;
    fresh();
    rigid(&model[0], 1.0, 0.4, 0.1, 0.2, 0.3, 0.2, 0.4);
    rigid(&model[1], 0.7, 0.3, -0.1, 0.1, 0.2, 0.3, 0.1);
    fbt_seed((unsigned)run + 1);
    hang(0, 0, FB_JOINT_SPHERICAL, FB_GROUND, 0);
    hang(1, 1, FB_JOINT_REVOLUTE, 0, 0);
    turn_anyhow(desc.joint[1].attitude, 1.0);
    memcpy(desc.joint[1].child_attitude, desc.joint[1].attitude, sizeof desc.joint[1].attitude);
    for (int l = 0; l < 2; l++) { /* closed where all coordinates are zero: the bodies' axes are those of the ground */
      loop = close_loop(l ? FB_JOINT_RIGID : FB_JOINT_SPHERICAL, l ? 0 : FB_GROUND, 0, 1, 0);
      for (int i = 0; i < 3; i++) {
        loop->position[i] = loop->child_position[i] = (fb_real)fbt_random();
      }
      turn_anyhow(loop->attitude, 1.0);
      memcpy(loop->child_attitude, loop->attitude, sizeof loop->attitude);
    }
    turn_anyhow(start[0].quat, 0.1);
    start[1].value[0] = (fb_real)(0.1 * fbt_random());
    init(FB_METHOD_DENSE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &other, &work, start, NULL), FB_OK);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_BELOW(fbt_difference(state.link[0].quat, other.link[0].quat, 4), FBT_TOL(1e-11, 1e-4));
    FBT_BELOW(fabs((double)(state.link[1].x[0] - other.link[1].x[0])), FBT_TOL(1e-11, 1e-4));
  }
}

/* E3.2, E9.4: a free body without mass moves as it likes along a slide that it carries, and about a hinge, however the
   joint is turned: refused, in units of any size. With a hundred thousandth of the child's mass and inertia (single: a
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
    status = fb_system_init(&mechanism, &work, model, &desc, 2);
    FBT_INT_EQ(status, part > 0.0 ? FB_OK : FB_ERR_SINGULAR);
  }
}

/* E9.4: a free rod has no inertia about its line. */
TEST(free_rods_are_refused)
{
  for (int line = 0; line < 4; line++) { /* 3: a rod with some thickness */
    for (int method = 0; method < FB_METHOD_COUNT; method++) {
      fresh();
      rigid(&model[0], 2.0, 0.1, 0.2, -0.1, line == 0 ? 0.0 : 1.0, line == 1 ? 0.0 : 1.0, line == 2 ? 0.0 : 1.0);
      hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
      desc.method = (fb_method)method;
      FBT_INT_EQ(fb_system_init(&mechanism, &work, model, &desc, 1), line < 3 ? FB_ERR_SINGULAR : FB_OK);
    }
  }
}

/* E9.7 to E9.10, E9.19: a free body that a loop ties to a link of the ground, away from the origin, moves as the child of
   that link. */
TEST(free_bodies_tied_to_links_of_the_ground_move_as_their_children)
{
  static const fb_joint_kind kind[] = {FB_JOINT_RIGID, FB_JOINT_REVOLUTE, FB_JOINT_PRISMATIC, FB_JOINT_CYLINDRICAL,
                                       FB_JOINT_SPHERICAL};
  static fb_system_motion child;
  for (int run = 0; run < FBT_COUNT(kind); run++) {
    for (int tied = 0; tied < 2; tied++) {
      fresh();
      rigid(&model[0], 3.0, 0.1, -0.05, 0.02, 0.3, 0.4, 0.5);
      rigid(&model[1], 0.7, 0.2, 0.1, -0.1, 0.03, 0.05, 0.04);
      hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
      hang(1, 1, kind[run], 0, 1);
      for (int k = 0; k < 2; k++) {
        desc.joint[k].position[0] = FB_R(0.5);
        desc.joint[k].position[1] = FB_R(2.0);
        turn(desc.joint[k].attitude, 0.3, -0.2, 0.5 + k);
        start[k].speed[0] = FB_R(1.5);
        start[k].speed[1] = -FB_R(0.5);
      }
      init(FB_METHOD_RECURSIVE);
      if (tied) {
        joints_to_loops(1);
        init(FB_METHOD_RECURSIVE);
      }
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
      for (int step = 0; step < 20; step++) {
        FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, FB_R(0.005)), FB_OK);
      }
      motion_of(tied ? &motion : &child, &state);
    }
    FBT_BELOW(motion_difference(&motion, &child), FBT_TOL(1e-8, 1e-3));
  }
}

SUITE(system_loops, RUN(free_rods_are_refused), RUN(free_bodies_tied_to_links_of_the_ground_move_as_their_children),
      RUN(free_bodies_without_mass_are_refused_in_every_attitude), RUN(springs_of_loops_pull_like_those_of_the_tree),
      RUN(a_prescribed_loop_closes_where_it_is_told), RUN(a_locked_loop_closes_where_the_free_one_does),
      RUN(loops_are_closed_the_right_way_round), RUN(what_a_loop_misses_is_relative),
      RUN(contradictions_name_their_joint), RUN(masses_do_not_make_rows_dependent),
      RUN(what_contradicts_a_loop_by_a_millionth_is_refused), RUN(methods_choose_the_same_of_equal_rows),
      RUN(loops_that_stand_still_contradict_no_prescribed_axis), RUN(linkages_swing_alike_in_any_unit_of_length),
      RUN(loops_slide_any_way), RUN(a_locked_ball_holds_where_it_closes), RUN(a_loop_closes_the_shortest_way),
      RUN(a_loop_that_closes_keeps_shape_and_momentum), RUN(a_loop_that_joints_cannot_close_bends_a_body_to_it),
      RUN(loops_close_from_rough_guesses), RUN(what_joints_can_close_is_not_bent), RUN(redundant_loops_are_accepted))
