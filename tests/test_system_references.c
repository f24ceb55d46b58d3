/* >>system: systems with a published or closed-form motion. */
#include "system.h"

static fb_system_analyse_work analyse_work;
static fb_spectrum spectrum;

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
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_trim(&mechanism, model, &state, &analyse_work, &input), FB_OK);
    for (int k = 1; k < 4; k++) {
      FBT_NEAR_ABS(state.link[k].x[0], 0.0, FBT_TOL(1e-14, 1e-6));
    }
    FBT_INT_EQ(fb_system_spectrum_solve(&mechanism, model, &analyse_work, &spectrum, &state, &input), FB_OK);
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, NULL, NULL), FB_OK);
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
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
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
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

SUITE(system_references, RUN(tops_follow_the_references), RUN(pendulums_of_rods_follow_their_equations),
      RUN(gimbal_has_the_published_eigenvalues), RUN(flexible_double_pendulum_follows_the_reference),
      RUN_LONG(slider_crank_follows_the_reference), RUN_LONG(a_parallelogram_passes_its_flat_positions))
