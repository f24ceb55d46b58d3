/* >>system: free joints on springs and dampers: bodies on moorings. */
#include "system.h"

static fb_system_state kept, rate;
static fb_system_analyse_work analyse_work;
static fb_spectrum spectrum;

/* Six unequal springs, dampers and rests of the joint of body 0. */
static void moor(double damping)
{
  static const double k[6] = {3.0, 5.0, 8.0, 2.0, 3.5, 6.0}, rest[6] = {0.2, -0.1, 0.3, 0.15, -0.2, 0.1};
  for (int i = 0; i < 6; i++) {
    desc.joint[0].stiffness[i] = (fb_real)k[i];
    desc.joint[0].rest[i] = (fb_real)rest[i];
    desc.joint[0].damping[i] = (fb_real)(damping * (0.1 + 0.05 * i));
  }
}

/* A rigid body whose mass center is off O, at a place and an attitude. */
static void floater(double x, double y, double z, double turn_x, double turn_y, double turn_z)
{
  fresh();
  rigid(&model[0], 2.0, 0.1, -0.2, 0.15, 0.4, 0.5, 0.7);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  start[0].value[0] = (fb_real)x;
  start[0].value[1] = (fb_real)y;
  start[0].value[2] = (fb_real)z;
  turn(start[0].quat, turn_x, turn_y, turn_z);
}

/* Energy with coordinate i moved by h: O along the ground's axes, then the attitude about the body's. */
static double energy_at(int i, double h)
{
  kept = state;
  if (i < 3) {
    kept.link[0].x[i] += (fb_real)h;
  } else {
    fb_real by[4];
    turn(by, i == 3 ? h : 0.0, i == 4 ? h : 0.0, i == 5 ? h : 0.0);
    fb_quat_mul(kept.link[0].quat, state.link[0].quat, by);
  }
  return energy_of(&kept);
}

/* E9.30: what the springs do to a body at rest is the gradient of sum k (x - rest)^2/2, for small rotations and almost half
   a turn, whatever the sign of the quaternion; the energy itself by hand. */
TEST(moorings_are_the_gradient_of_their_energy)
{
  static const double angle[4][3] = {{0.01, -0.02, 0.005}, {0.5, -0.7, 0.4}, {-1.6, 0.9, 1.2}, {1.5, 1.9, -1.8}};
  const double h = FBT_TOL(1e-4, 2e-2);
  for (int run = 0; run < 8; run++) {
    const double *const a = angle[run / 2];
    double slope[6], want = 0.0;
    fb_real R[9], moment[3], force[3], push[3];
    const fb_real center[3] = {FB_R(0.1), -FB_R(0.2), FB_R(0.15)};
    floater(1.2, -0.8, 0.5, a[0], a[1], a[2]);
    moor(1.0);
    init(run % 2);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    for (int i = 0; i < 6; i++) {
      const fb_joint_desc *const j = &desc.joint[0];
      const double off = (i < 3 ? (double)start[0].value[i] : a[i - 3]) - (double)j->rest[i];
      want += 0.5 * (double)j->stiffness[i] * off * off;
    }
    FBT_NEAR_REL(energy_of(&state), want, FBT_TOL(1e-13, 1e-5));
    for (int i = 0; run % 2 && i < 4; i++) {
      state.link[0].quat[i] = -state.link[0].quat[i];
    }
    FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, NULL), FB_OK);
    fb_quat_to_mat33(R, state.link[0].quat);
    fb_mat33_mulT_vec3(moment, R, rate.link[0].p + 3);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    fb_vec3_cross(push, motion.motion[0].w_dot, center);
    for (int i = 0; i < 3; i++) { /* Newton's law at rest: m (a + w_dot x c) */
      push[i] = FB_R(2.0) * (motion.motion[0].acceleration[i] + push[i]);
    }
    fb_mat33_mulT_vec3(force, R, rate.link[0].p);
    FBT_BELOW(fbt_difference(push, force, 3), FBT_TOL(1e-13, 1e-5) * fbt_largest(force, 3));
    FBT_BELOW(fbt_difference(motion.joint[0].force, rate.link[0].p, 3), FBT_TOL(1e-13, 1e-5) * fbt_largest(force, 3));
    for (int i = 0; i < 6; i++) {
      slope[i] =
          (8.0 * (energy_at(i, h) - energy_at(i, -h)) - energy_at(i, 2.0 * h) + energy_at(i, -2.0 * h)) / (12.0 * h);
      FBT_NEAR_ABS(i < 3 ? rate.link[0].p[i] : moment[i - 3], -slope[i], FBT_TOL(1e-8, 1e-2));
    }
  }
}

/* E9.30, E9.15: the energy of a tree whose root is moored falls by what dampers take, of the root c v^2 along the ground's
   axes and c w^2 about the body's, by either method, flexible bodies on it. */
TEST(moorings_balance_energy)
{
  static const double weight[5] = {1.0 / 12, -2.0 / 3, 0, 2.0 / 3, -1.0 / 12};
  const double h = FBT_TOL(1e-4, 1e-2);
  for (int run = 0; run < 4; run++) {
    double slope = 0.0, power = 0.0;
    fb_real R[9], v[3];
    tree(run < 2 ? FB_EFFECTS_FULL : FB_EFFECTS_LARGE, 1);
    moor(1.0);
    init(run % 2);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, NULL), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    fb_quat_to_mat33(R, motion.pose[0].quat);
    fb_mat33_mul_vec3(v, R, motion.motion[0].v);
    for (int i = 0; i < 3; i++) {
      power -= (double)(desc.joint[0].damping[i] * v[i] * v[i]);
      power -= (double)(desc.joint[0].damping[3 + i] * motion.motion[0].w[i] * motion.motion[0].w[i]);
    }
    for (int k = 1; k < desc.n_body; k++) {
      for (int i = 0; i < mechanism.joint[k].n_axis; i++) {
        power -= (double)(mechanism.joint[k].damping[i] * motion.joint[k].speed[i] * motion.joint[k].speed[i]);
      }
    }
    for (int side = -2; side <= 2; side++) {
      moved(&kept, &state, &rate, side * h);
      slope += weight[side + 2] / h * energy_of(&kept);
    }
    FBT_NEAR_ABS(slope, power, FBT_TOL(1e-7, 2e-1));
  }
}

/* Body 0 moored, or on three massless carriages along x, y, z and a ball joint; after 60 steps of dt. */
static void ride(fb_state *pose, int carriages, int method, int iterations, double dt)
{
  static const double k[3] = {30.0, 50.0, 80.0}, c[3] = {0.4, 0.7, 0.2}, rest[3] = {0.1, -0.2, 0.3},
                      x[3] = {0.5, -0.4, 0.2};
  const int last = carriages ? 3 : 0;
  fb_joint_desc *ball;
  fresh();
  rigid(&model[last ? 1 : 0], 2.0, 0.1, -0.2, 0.15, 0.4, 0.5, 0.7);
  rigid(&model[last ? 0 : 1], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
  hang(last, last ? 1 : 0, carriages ? FB_JOINT_SPHERICAL : FB_JOINT_FREE, last - 1, 0);
  ball = &desc.joint[last];
  for (int i = 0; i < 3; i++) {
    fb_joint_desc *const j = &desc.joint[carriages ? i : 0];
    const int at = carriages ? 0 : i;
    if (carriages) {
      hang(i, 0, FB_JOINT_PRISMATIC, i - 1, 0);
      j->axis[i] = FB_R(1.0);
    }
    j->stiffness[at] = (fb_real)k[i];
    j->damping[at] = (fb_real)c[i];
    j->rest[at] = (fb_real)rest[i];
    start[carriages ? i : 0].value[at] = (fb_real)x[i];
    ball->stiffness[carriages ? i : 3 + i] = FB_R(9.0);
    ball->damping[carriages ? i : 3 + i] = FB_R(0.3);
    start[last].speed[carriages ? i : 3 + i] = FB_R(0.5);
  }
  turn(start[last].quat, 0.9, -1.2, 0.7);
  init(method);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
  for (int step = 0; step < 60; step++) {
    FBT_INT_EQ(iterations ? fb_system_sdirk_step(&mechanism, model, &state, &work, NULL, NULL, (fb_real)dt, iterations)
                          : fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, (fb_real)dt),
               FB_OK);
  }
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
  *pose = motion.pose[last];
}

/* E9.30, E9.11: with equal springs about all axes a moored body is one on three massless carriages and a ball joint, through
   1.6 rad, by rk4, by SDIRK and by either method. */
TEST(moorings_are_massless_carriages)
{
  fb_state moored, carried;
  for (int run = 0; run < 4; run++) {
    const int iterations = run < 2 ? 0 : 6;
    const double tol = FBT_TOL(run < 2 ? 1e-7 : 1e-4, 2e-4);
    ride(&moored, 0, run % 2, iterations, 0.01);
    ride(&carried, 1, run % 2, iterations, 0.01);
    FBT_BELOW(fbt_difference(moored.rho, carried.rho, 3), tol * fbt_largest(carried.rho, 3));
    FBT_BELOW(fbt_difference(moored.quat, carried.quat, 4), tol);
  }
}

/* The frequencies of [m, m c; m c, J + m c^2] against diag(k, kappa), rad/s, the lower one first. */
static void pair(double w[2], double m, double c, double J, double k, double kappa)
{
  const double a = m * (J + m * c * c) - m * m * c * c, b = m * kappa + (J + m * c * c) * k, d = k * kappa;
  w[0] = sqrt((b - sqrt(b * b - 4.0 * a * d)) / (2.0 * a));
  w[1] = sqrt((b + sqrt(b * b - 4.0 * a * d)) / (2.0 * a));
}

static int ascending(const void *a, const void *b)
{
  return (*(const double *)a > *(const double *)b) - (*(const double *)a < *(const double *)b);
}

/* E9.30, E12.8 to E12.10: a floater with its mass center c above O sinks by m g/k and has, there, the frequencies of M^-1 K:
   surge with pitch and sway with roll, whose springs lose m g c, heave and yaw. Without a spring of yaw or surge the trim
   finds it, too, and its other frequencies are the same. */
TEST(floaters_have_the_frequencies_of_their_matrices)
{
  const double m = 3.0, c = 0.4, g = 9.81, J[3] = {0.7, 0.9, 1.3}, k[6] = {40.0, 55.0, 90.0, 30.0, 36.0, 20.0};
  for (int run = 0; run < 4; run++) {
    double want[6];
    int soft = 0;
    fresh();
    body_desc.effects = FB_EFFECT_GRAVITY;
    body_desc.gravity[2] = -(fb_real)g;
    rigid(&model[0], m, 0.0, 0.0, c, J[0], J[1], J[2]);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    for (int i = 0; i < 6; i++) {
      desc.joint[0].stiffness[i] = run > 1 && i == 5 ? FB_R(0.0) : (fb_real)k[i];
    }
    init(run % 2);
    turn(start[0].quat, 0.1, run > 1 ? 0.0 : -0.05, run > 1 ? 0.0 : 0.02);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_trim(&mechanism, model, &state, &analyse_work, NULL), FB_OK);
    FBT_NEAR_REL(state.link[0].x[2], -m * g / k[2], FBT_TOL(1e-10, 1e-4));
    FBT_NEAR_REL(state.link[0].quat[0], 1.0, FBT_TOL(1e-12, 1e-5));
    FBT_INT_EQ(fb_system_spectrum_solve(&mechanism, model, &analyse_work, &spectrum, &state, NULL), FB_OK);
    pair(want, m, c, J[1], k[0], k[4] - m * g * c);
    pair(want + 2, m, c, J[0], k[1], k[3] - m * g * c);
    want[4] = sqrt(k[2] / m);
    want[5] = run > 1 ? 0.0 : sqrt(k[5] / J[2]);
    qsort(want, 6, sizeof *want, ascending);
    for (int i = 0; i < spectrum.n; i++) {
      soft += fabs((double)spectrum.im[i]) < FBT_TOL(1e-3, 1e-1);
    }
    FBT_INT_EQ(soft, run > 1 ? 2 : 0); /* yaw and its rate */
    for (int i = 0; i < spectrum.n - soft; i++) {
      FBT_NEAR_REL(spectrum.im[soft + i], want[(run > 1) + i], FBT_TOL(1e-8, 1e-3));
    }
  }
}

/* E9.30, E12.8: wherever the trim begins, a body on springs that bear nothing is found where they rest, and a force moves it
   by F/k. Its place and rotation along and about axes without springs stay as they are, at any attitude; a force along one
   of them has no state of rest. */
TEST(moorings_are_trimmed_to_where_they_rest)
{
  static const double begin[4][3] = {{0, 0, 0}, {0.5, -0.3, 0.4}, {0.2, 0.3, 1.4}, {1.7, -0.9, 1.4}};
  static const double rest[2][6] = {{0.2, -0.1, 0.3, 2.0, -1.0, 1.5}, {0.2, 0.0, 0.0, 0.0, -0.4, 1.2}};
  for (int run = 0; run < 16; run++) {
    const int some = run / 4 % 2, pushed = run / 8, k = run % 4;
    const double push = pushed ? -9.0 : 0.0;
    fb_real turned[3];
    floater(0.7, 7.0, -5.0, 0, 0, 0);
    for (int i = 0; i < 6; i++) {
      desc.joint[0].stiffness[i] = some && i > 0 && i < 4 ? FB_R(0.0) : (fb_real)(20.0 + 7.0 * i);
      desc.joint[0].rest[i] = (fb_real)rest[some][i];
    }
    turn(start[0].quat, begin[k][0], begin[k][1], begin[k][2]);
    init(run % 2);
    input.n_load = 1;
    for (int i = 0; i < 3; i++) { /* at the origin, which the springs hold */
      input.load[0].load.force[i] = i ? FB_R(0.0) : (fb_real)push;
    }
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_trim(&mechanism, model, &state, &analyse_work, &input), FB_OK);
    fb_quat_to_rotvec(turned, state.link[0].quat);
    FBT_NEAR_REL(state.link[0].x[0], 0.2 + push / 20.0, FBT_TOL(1e-11, 1e-4));
    for (int i = 1; i < 6; i++) {
      const double at = some && i < 4 ? (i < 3 ? (double)start[0].value[i] : begin[k][0]) : rest[some][i];
      FBT_NEAR_ABS(i < 3 ? state.link[0].x[i] : turned[i - 3], at, FBT_TOL(1e-11, 1e-4));
    }
    for (int i = 1; i < 3 && some && pushed; i++) {
      input.load[0].load.force[i] = FB_R(1.0);
      FBT_INT_EQ(fb_system_trim(&mechanism, model, &state, &analyse_work, &input), FB_ERR_UNREST);
      input.load[0].load.force[i] = FB_R(0.0);
    }
  }
}

/* E9.30, E11.13: SDIRK keeps its order through a radian of rotation on unequal springs, and on springs a million times as
   stiff, of which rk4 refuses its steps, it comes to rest where the load holds them. */
TEST(stiff_moorings_take_long_steps)
{
  fb_real end[3][7];
  fb_system_limit limit;
  for (int run = 0; run < 3; run++) {
    const int steps = 160 << (run == 2 ? 4 : run);
    floater(0.4, 0.1, 0.5, 0.7, -0.8, 0.5);
    moor(1.0);
    init(run % 2);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    for (int k = 0; k < steps; k++) {
      FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, NULL, NULL, (fb_real)(2.0 / steps), 8), FB_OK);
    }
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    memcpy(end[run], motion.pose[0].rho, 3 * sizeof(fb_real));
    memcpy(end[run] + 3, motion.pose[0].quat, 4 * sizeof(fb_real));
  }
  FBT_NEAR_ABS(log2((double)(fbt_difference(end[0], end[2], 7) / fbt_difference(end[1], end[2], 7))), 2.0,
               FBT_TOL(0.2, 0.4));

  for (int form = 0; form < 2; form++) {
    const double load[3] = {3e4, -2e4, 1e4};
    floater(0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    moor(1.0);
    for (int i = 0; i < 6; i++) {
      desc.joint[0].stiffness[i] *= FB_R(1e6);
      desc.joint[0].rest[i] = FB_R(0.0);
    }
    init(form);
    input.n_load = 1;
    for (int i = 0; i < 3; i++) {
      input.load[0].load.force[i] = (fb_real)load[i];
      input.load[0].load.torque[i] = (fb_real)load[i];
    }
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_limit_eval(&mechanism, model, &work, &limit, &state, &input), FB_OK);
    FBT_BELOW(limit.rk4, 2e-3);
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(0.1)), FB_ERR_STEP);
    for (int k = 0; k < 300; k++) {
      FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, FB_R(0.1), 6), FB_OK);
    }
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_REL(state.link[0].x[i], load[i] / (double)desc.joint[0].stiffness[i], FBT_TOL(1e-6, 1e-3));
    }
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    for (int i = 0; i < 3; i++) { /* what the joint does to the body */
      FBT_NEAR_REL(motion.joint[0].force[i], -load[i], FBT_TOL(1e-6, 1e-2));
      FBT_NEAR_REL(motion.joint[0].torque[i], -load[i], FBT_TOL(1e-6, 1e-2));
    }
    FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, &input), FB_OK);
    for (int i = 0; i < 6; i++) {
      FBT_BELOW(fabs((double)rate.link[0].p[i]) / 3e4, FBT_TOL(1e-6, 1e-2));
    }
  }
}

/* E9.30: springs that rest at a rotation of 2.6 rad, 0.1 s being 50 times the longest step of rk4: three iterations find the balance of
   a moment with the gradient of the energy. */
TEST(stiff_moorings_that_rest_at_a_turn_take_long_steps)
{
  static const double rest[3] = {1.6, 1.9, -0.8}, load[3] = {3e3, -2e3, 1e3};
  const double h = FBT_TOL(1e-5, 1e-2);
  for (int form = 0; form < 2; form++) {
    floater(0.0, 0.0, 0.0, rest[0], rest[1], rest[2]);
    moor(1.0);
    for (int i = 0; i < 6; i++) {
      desc.joint[0].stiffness[i] *= FB_R(1e6);
      desc.joint[0].damping[i] *= FB_R(1e3);
      desc.joint[0].rest[i] = (fb_real)(i < 3 ? 0.0 : rest[i - 3]);
    }
    init(form);
    input.n_load = 1;
    input.load[0].load.axes = FB_AXES_BODY;
    for (int i = 0; i < 3; i++) {
      input.load[0].load.torque[i] = (fb_real)load[i];
    }
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    for (int k = 0; k < 200; k++) {
      FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, FB_R(0.1), 3), FB_OK);
    }
    for (int i = 0; i < 3; i++) {
      const double slope = (energy_at(3 + i, h) - energy_at(3 + i, -h)) / (2.0 * h);
      FBT_NEAR_ABS(slope, load[i], FBT_TOL(1e-3, 3e-2) * 3e3);
    }
  }
}

/* E9.30, E11.12: the limit of rk4 is that of the fastest frequency, of round bodies sqrt(k/m) and sqrt(k/J), and of dampers. */
TEST(moorings_bound_the_step)
{
  for (int axis = 0; axis < 6; axis++) {
    fb_system_limit limit;
    fresh();
    rigid(&model[0], 2.0, 0, 0, 0, 0.5, 0.5, 0.5);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    desc.joint[0].stiffness[axis] = FB_R(800.0);
    init(axis % 2);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_limit_eval(&mechanism, model, &work, &limit, &state, NULL), FB_OK);
    FBT_NEAR_REL(limit.rk4, 2.0 * sqrt(2.0) / sqrt(800.0 / (axis < 3 ? 2.0 : 0.5)), 0.06);
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, limit.rk4 * FB_R(1.1)),
               FB_ERR_STEP);
  }
}

/* E9.30, E11.12: where the springs rest turned by t about z one about x has the frequency (t/2)/sin(t/2) sqrt(k/J); where they
   turn the body by 90 degrees, or not at all, a spring along x acts across a mass center a off along x, whose frequency is
   sqrt(k (1/m + a^2/J)). Steps at the limit are stable. */
TEST(moorings_bound_the_step_where_they_rest)
{
  const double m = 2.0, J = 0.5, k = 800.0, a = 0.8;
  for (int run = 0; run < 6; run++) {
    const double t = run < 3 ? 1.0 + run : run == 5 ? 0.0 : 1.5707963267948966;
    const double w2 = run < 3 ? k / J * pow(0.5 * t / sin(0.5 * t), 2.0) : k * (1.0 / m + a * a / J);
    fb_system_limit limit;
    fresh();
    rigid(&model[0], m, run < 3 ? 0 : a, 0, 0, J, J, J);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    desc.joint[0].stiffness[run < 3 ? 3 : 0] = (fb_real)k;
    desc.joint[0].stiffness[5] = run == 5 ? FB_R(0.0) : FB_R(5.0);
    desc.joint[0].rest[5] = (fb_real)t;
    turn(start[0].quat, 0.0, 0.0, run == 5 ? 1.5707963267948966 : t);
    start[0].value[0] = FB_R(1e-4);
    start[0].speed[3] = FB_R(1e-3);
    init(run % 2);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_limit_eval(&mechanism, model, &work, &limit, &state, NULL), FB_OK);
    FBT_NEAR_REL(limit.rk4, 2.0 * sqrt(2.0) / sqrt(w2), 0.06);
    for (int step = 0; step < 400; step++) {
      FBT_INT_EQ(
          fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, (fb_real)(0.999 * (double)limit.rk4)),
          FB_OK);
    }
  }
}

/* Interface: what a moored joint refuses: frames of its own, springs of axes that it does not have, half a turn. */
TEST(moorings_are_checked)
{
  fb_real *const frame[] = {desc.joint[0].position, desc.joint[0].child_position, desc.joint[0].axis};
  for (int i = 0; i < FBT_COUNT(frame); i++) {
    floater(0, 0, 0, 0, 0, 0);
    frame[i][2] = FB_R(1.0);
    FBT_INT_EQ(fb_system_init(&mechanism, &work, model, &desc, 1), FB_OK);
    desc.joint[0].damping[4] = FB_R(1.0);
    FBT_INT_EQ(fb_system_init(&mechanism, &work, model, &desc, 1), FB_ERR_VALUE);
  }
  for (int i = 0; i < 6; i++) {
    floater(0, 0, 0, 0, 0, 0);
    desc.joint[0].stiffness[i] = -FB_R(1.0);
    FBT_INT_EQ(fb_system_init(&mechanism, &work, model, &desc, 1), FB_ERR_VALUE);
  }
  floater(0, 0, 0, 0, 0, 0);
  desc.joint[0].kind = FB_JOINT_SPHERICAL;
  desc.joint[0].parent = FB_GROUND;
  desc.joint[0].stiffness[3] = FB_R(1.0);
  FBT_INT_EQ(fb_system_init(&mechanism, &work, model, &desc, 1), FB_ERR_VALUE);
  for (int sprung = 0; sprung < 2; sprung++) {
    floater(0, 0, 0, 3.12, 0, 0);
    desc.joint[0].stiffness[sprung ? 3 : 0] = FB_R(1.0);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, NULL), sprung ? FB_ERR_RANGE : FB_OK);
  }
}

/* E9.30: what prescribes a moored body works against its springs and dampers: gradient of the energy times the velocity, and
   c v^2, c w^2 of the dampers, beside the power without moorings. */
TEST(what_prescribes_a_moored_body_works_against_the_moorings)
{
  const double h = FBT_TOL(1e-4, 2e-2);
  double want = 0.0, power[2];
  for (int moored = 0; moored < 2; moored++) {
    floater(1.2, -0.8, 0.5, 0.5, -0.7, 0.4);
    desc.joint[0].mode[0] = FB_AXIS_PRESCRIBED;
    if (moored) {
      moor(1.0);
    }
    init(FB_METHOD_RECURSIVE);
    memset(&input, 0, sizeof input);
    for (int i = 0; i < 6; i++) {
      input.drive[0].rate[i] = (fb_real)(0.3 + 0.2 * i);
      input.drive[0].acceleration[i] = (fb_real)(0.5 - 0.1 * i);
    }
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    power[moored] = (double)motion.power;
  }
  fb_real R[9], v[3];
  fb_quat_to_mat33(R, motion.pose[0].quat);
  fb_mat33_mul_vec3(v, R, motion.motion[0].v);
  for (int i = 0; i < 6; i++) {
    const double u = (double)(i < 3 ? v[i] : motion.motion[0].w[i - 3]);
    const double slope =
        (8.0 * (energy_at(i, h) - energy_at(i, -h)) - energy_at(i, 2.0 * h) + energy_at(i, -2.0 * h)) / (12.0 * h);
    want += slope * u + (double)desc.joint[0].damping[i] * u * u;
  }
  FBT_NEAR_ABS(power[1] - power[0], want, FBT_TOL(1e-8, 2e-2));
}

SUITE(system_moorings, RUN(moorings_are_the_gradient_of_their_energy), RUN(moorings_balance_energy),
      RUN(what_prescribes_a_moored_body_works_against_the_moorings), RUN(moorings_are_massless_carriages),
      RUN(floaters_have_the_frequencies_of_their_matrices), RUN(moorings_are_trimmed_to_where_they_rest),
      RUN(stiff_moorings_take_long_steps), RUN(stiff_moorings_that_rest_at_a_turn_take_long_steps),
      RUN(moorings_bound_the_step), RUN(moorings_bound_the_step_where_they_rest), RUN(moorings_are_checked))
