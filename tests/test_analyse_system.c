/* >>trim and >>linear: states of rest, spectra and linear models of systems. */
#include "analyse.h"

static fb_analyse_work work;

/* ---- systems */

/* E12.8 to E12.10: a rigid blade, a lamina in the rotor's plane (J_z = J_x + J_y), on a ball joint with springs k: its
   potential -Omega^2 I_spin/2 gives, uncoupled, lag^2 = Omega^2 e m c/J_z + k/J_z, flap^2 = Omega^2 (1 + e m c/J_y) +
   k/J_y, pitch^2 = Omega^2 + k/J_x. On a universal joint there is no pitch, on a hinge no lag. From a guess off it the
   trim finds the blade straight. */
TEST(hinged_blades_flap_and_lag_in_closed_form)
{
  static const fb_joint_kind kinds[3] = {FB_JOINT_REVOLUTE, FB_JOINT_UNIVERSAL, FB_JOINT_SPHERICAL};
  double largest = 0.0;
  for (int run = 0; run < 12; run++) {
    const fb_joint_kind kind = kinds[run % 3];
    const double Omega = 3.0 + run, e = 0.1 + 0.05 * run, m = 2.0, c = 0.7, k = run / 3 % 2 ? 20.0 : 0.0;
    const double jx = 0.05, jy = 1.3, jz = jx + jy, emc = e * m * c, square = Omega * Omega;
    const double lag = sqrt((square * emc + k) / jz), flap = sqrt(square + (square * emc + k) / jy);
    const double pitch = sqrt(square + k / jx);
    double want[3] = {lag, flap, pitch};
    int n = 3;
    fb_joint_desc *hinge;
    rotor(Omega);
    rigid_part(1, m, c, jx, jy, jz, 0.0);
    hinge = hang(1, 1, kind, 0);
    hinge->position[0] = (fb_real)e;
    hinge->stiffness[0] = hinge->stiffness[1] = (fb_real)k;
    if (kind == FB_JOINT_REVOLUTE) { /* z of the joint along -y */
      frame_turn(hinge->attitude, pi / 2, 0.0, 0.0);
      frame_turn(hinge->child_attitude, pi / 2, 0.0, 0.0);
      want[0] = flap;
      n = 1;
    } else if (kind == FB_JOINT_UNIVERSAL) { /* z up, x along -y */
      frame_turn(hinge->attitude, 0.0, 0.0, -pi / 2);
      frame_turn(hinge->child_attitude, 0.0, 0.0, -pi / 2);
      n = 2;
    }
    start[1].value[0] = FB_R(0.2);
    start[1].value[1] = kind == FB_JOINT_UNIVERSAL ? -FB_R(0.1) : FB_R(0.0);
    frame_turn(start[1].quat, 0.1, -0.2, 0.05);
    build();
    trim_and_modes();
    if (kind == FB_JOINT_SPHERICAL) {
      FBT_NEAR_ABS(tree_state.link[1].quat[0], 1.0, 8.0 * EPS);
    } else {
      FBT_NEAR_ABS(tree_state.link[1].x[0], 0.0, 64.0 * EPS);
    }
    FBT_INT_EQ(spectrum.n, n);
    if (want[1] > want[2] && n == 3) { /* ascending */
      want[1] = pitch;
      want[2] = flap;
    }
    for (int i = 0; i < n && i < spectrum.n; i++) {
      FBT_NEAR_REL(spectrum.im[i], want[i], FBT_TOL(1e-10, 1e-3));
      FBT_NEAR_ABS(spectrum.re[i], 0.0, FBT_TOL(1e-10, 1e-3) * Omega);
      largest = fmax(largest, fabs((double)spectrum.im[i] / want[i] - 1.0));
    }
  }
  fbt_figure("rigid blade on hinges, flap, lag and pitch", "closed form", largest);
}

/* E12.8, E12.9: a constant moment M about a flap hinge on the axis cones the blade by sin 2 beta = 2 M/(Omega^2 (J_z -
   J_x)); about that it swings with Omega^2 (J_z - J_x) cos 2 beta/J_y. Beyond 45 degrees there is no equilibrium. */
TEST(blades_cone_under_a_moment)
{
  for (int run = 1; run < 7; run++) {
    const double Omega = 4.0, jx = 0.1, jy = 1.25, jz = 1.2, hold = Omega * Omega * (jz - jx),
                 M = 0.16 * run * hold / 2.0;
    const double beta = 0.5 * asin(0.16 * run), omega = sqrt(hold * cos(2.0 * beta) / jy);
    fb_joint_desc *hinge;
    rotor(Omega);
    rigid_part(1, 2.0, 0.7, jx, jy, jz, 0.0);
    hinge = hang(1, 1, FB_JOINT_REVOLUTE, 0);
    frame_turn(hinge->attitude, pi / 2, 0.0, 0.0);
    frame_turn(hinge->child_attitude, pi / 2, 0.0, 0.0);
    drive.drive[1].torque[0] = (fb_real)M;
    build();
    drive.drive[0].value[0] = FB_R(0.3); /* the motor is elsewhere by now */
    trim_and_modes();
    FBT_NEAR_ABS(tree_state.link[0].x[0], 0.3, EPS);
    FBT_NEAR_ABS(tree_state.link[1].x[0], beta, FBT_TOL(1e-13, 1e-5));
    FBT_NEAR_REL(spectrum.im[0], omega, FBT_TOL(1e-11, 1e-4));
  }
  {
    const fb_system_state before = tree_state;
    fb_status status;
    drive.drive[1].torque[0] = FB_R(10.0);
    status = fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive);
    FBT_TRUE(status == FB_ERR_CONVERGENCE || status == FB_ERR_SINGULAR || status == FB_ERR_NOT_FINITE);
    FBT_TRUE(memcmp(&before, &tree_state, sizeof before) == 0);
  }
}

/* E12.8, E12.19: an arm that its drive turns beside the axis of a rotor changes the centrifugal field of what hangs on it:
   steady while it stands, not while it moves. About the axis of the rotor it may turn: the whole then spins faster. The
   drive is that of its hinge, or of a second hinge in the same place, a loop. */
TEST(axes_that_move_on_end_what_is_steady)
{
  for (int run = 0; run < 8; run++) {
    const int moves = run % 2, beside = run / 2 % 2, loop = run / 4, driven = loop ? 3 : 1;
    fb_joint_desc *hinge;
    rotor(4.0);
    rigid_part(1, 2.0, 0.4, 0.05, 0.6, 0.6, 0.0);
    hinge = hang(1, 1, FB_JOINT_REVOLUTE, 0);
    hinge->position[0] = beside ? FB_R(0.5) : FB_R(0.0);
    tree.loop[0] = *hinge;
    tree.loop[0].child = 1;
    tree.n_loop = loop;
    (loop ? &tree.loop[0] : hinge)->mode[0] = FB_AXIS_PRESCRIBED;
    hinge = hang(2, 1, FB_JOINT_REVOLUTE, 1);
    hinge->parent_node = 1;
    hinge->stiffness[0] = FB_R(20.0);
    start[1].value[0] = drive.drive[driven].value[0] = FB_R(0.6);
    start[1].speed[0] = drive.drive[driven].rate[0] = moves ? FB_R(0.7) : FB_R(0.0);
    if (!loop) { /* of no loop nothing may be filled */
      memset(&tree.loop[0], 0, sizeof tree.loop[0]);
    }
    build();
    FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive),
               moves && beside ? FB_ERR_UNREST : FB_OK);
    if (moves && beside) {
      FBT_INT_EQ(tree_work.system.joint, driven);
    }
  }
}

/* E12.1, E12.8: a free, pinned or hinged body rests where what acts on it is in balance: a beam that hangs from its
   hinge, straight, or hovers by a force and a torque on its hub, bent as one whose hub is held. Gravity or thrust alone
   leaves no state of rest, nor do wheels with momentum across the spin but under a torque that turns it; as a body and
   as what hangs on a free joint. */
TEST(bases_that_are_pushed_have_no_state_of_rest)
{
  const fb_real center[3] = {0}, J[6] = {FB_R(0.8), FB_R(0.5), FB_R(0.9), 0, 0, 0};
  fb_real sag[4] = {0};
  fb_motion held;
  for (int base = 0; base < 4; base++) {
    fb_state state, before;
    fb_input input;
    memset(&input, 0, sizeof input);
    uniform_line(2.0, 6, 0.5, 40.0, 60.0, 2);
    level.effects = FB_EFFECTS_FULL | FB_EFFECT_GRAVITY;
    level.gravity[1] = -FB_R(9.81);
    level.base = base == 0   ? FB_BASE_PRESCRIBED
                 : base == 1 ? FB_BASE_PINNED
                 : base == 2 ? FB_BASE_HINGED
                             : FB_BASE_FREE;
    beam_body(&body, 2.0, center, J);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    before = state;
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), base ? FB_ERR_UNREST : FB_OK);
    if (base == 0) {
      memcpy(sag, state.q, sizeof sag);
      FBT_INT_EQ(fb_body_motion_eval(&body, &held, &state, &input), FB_OK);
      FBT_TRUE(fbt_largest(sag, 4) > 0.01);
      continue;
    }
    FBT_TRUE(memcmp(&state, &before, sizeof state) == 0);
    frame_turn(state.quat, 0.0, 0.0, -pi / 2); /* downwards */
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), base == 3 ? FB_ERR_UNREST : FB_OK);
    FBT_BELOW(fbt_largest(state.q, 4), FBT_TOL(1e-12, 1e-6));
    input.w[2] = FB_R(0.1); /* not for long */
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_UNREST);
    input.w[2] = FB_R(0.0);
    state = before;
    input.n_load = 1;
    input.load[0].axes = FB_AXES_BODY;
    memcpy(input.load[0].force, held.reaction_force, sizeof held.reaction_force);
    memcpy(input.load[0].torque, held.reaction_torque, sizeof held.reaction_torque);
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_OK);
    FBT_BELOW(fbt_difference(state.q, sag, 4), FBT_TOL(1e-9, 1e-5));
    input.load[0].torque[2] = FB_R(0.0);
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_UNREST);
  }
  boom_loop(FB_AXIS_FREE); /* at rest it is so to rounding: springs press on the loop */
  drive.drive[0].rate[5] = FB_R(0.0);
  build();
  FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), FB_OK);
  for (int run = 0; run < 5; run++) { /* a wheel along or across; a push; w x h, which turns the wheel across */
    fb_joint_desc *wheel;
    fb_system_state before;
    fresh();
    rigid_part(0, 8.0, 0.0, 3.0, 4.0, 6.0, 0.0);
    rigid_part(1, 1.0, 0.0, 0.1, 0.1, 0.2, 0.0);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND);
    wheel = hang(1, 1, FB_JOINT_REVOLUTE, 0);
    wheel->mode[0] = FB_AXIS_PRESCRIBED;
    frame_turn(wheel->attitude, run % 3 == 1 ? pi / 2 : 0.0, 0.0, 0.0);
    drive.drive[0].rate[5] = run == 3 ? FB_R(0.0) : FB_R(0.7);
    drive.drive[1].rate[0] = FB_R(20.0);
    drive.n_load = run >= 2;
    drive.load[0].load.axes = FB_AXES_BODY;
    (run % 2 ? drive.load[0].load.force : drive.load[0].load.torque)[0] = run == 4 ? FB_R(2.8) : FB_R(0.01);
    build();
    before = tree_state;
    FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), run % 4 ? FB_ERR_UNREST : FB_OK);
    if (run % 4) {
      FBT_INT_EQ(tree_work.system.joint, 0);
      FBT_TRUE(memcmp(&before, &tree_state, sizeof before) == 0);
    }
  }
}

/* E12.8 to E12.10: a double pendulum of equal particles swings about its hanging position, found from one aside, with
   omega^2 = (2 -+ sqrt 2) g/l, the lower particle by +-sqrt 2 of the upper; by the dense method, too. */
TEST(double_pendulum_swings_in_closed_form)
{
  for (int run = 0; run < 2; run++) {
    const double g = 9.81, l = 0.6, m = 1.5, I = m * l * l;
    fresh();
    rigid_part(0, m, l, 0.0, I, I, g);
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND);
    hang(1, 0, FB_JOINT_REVOLUTE, 0)->position[0] = (fb_real)l;
    tree.method = run ? FB_METHOD_DENSE : FB_METHOD_RECURSIVE;
    start[0].value[0] = FB_R(0.5);
    start[1].value[0] = -FB_R(0.4);
    start[0].speed[0] = FB_R(0.3);
    build();
    trim_and_modes();
    FBT_NEAR_ABS(tree_state.link[0].x[0], 0.0, 64.0 * EPS);
    FBT_NEAR_ABS(tree_state.link[1].x[0], 0.0, 64.0 * EPS);
    FBT_NEAR_ABS(tree_state.link[0].p[0], 0.0, EPS);
    FBT_INT_EQ(spectrum.n, 2);
    for (int k = 0; k < 2; k++) {
      const double sign = k ? -1.0 : 1.0;
      const number upper = {(double)spectrum.shape_re[2 * k], (double)spectrum.shape_im[2 * k]};
      const number joint = {(double)spectrum.shape_re[2 * k + 1], (double)spectrum.shape_im[2 * k + 1]};
      const number miss = plus(joint, 1.0 - sign * sqrt(2.0), upper); /* lower = upper + joint = +-sqrt 2 upper */
      FBT_NEAR_REL(spectrum.im[k], sqrt((2.0 - sign * sqrt(2.0)) * g / l), FBT_TOL(1e-11, 1e-4));
      FBT_BELOW(hypot(miss.re, miss.im) / hypot(upper.re, upper.im), FBT_TOL(1e-10, 1e-3));
    }
  }
}

/* E12.3, E12.10: two forces F that pull a free body apart at its ends, a distance l from its center, and stay along x
   of inertial axes turn it back with 2 F l: omega^2 = 2 F l/J about y and about z. As a body and as a system of one. */
TEST(opposite_pulls_hold_a_free_body)
{
  const double F = 3.0, l = 0.8, J_y = 0.5, J_z = 0.9;
  const fb_real center[3] = {0}, J[6] = {FB_R(0.7), (fb_real)J_y, (fb_real)J_z, 0, 0, 0};
  fb_state state;
  fb_input input;
  fresh();
  memset(&level, 0, sizeof level);
  memset(&input, 0, sizeof input);
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(2.0), center, J), FB_OK);
  for (int k = 0; k < 2; k++) {
    const fb_real end[3] = {(fb_real)(k ? -l : l), 0, 0};
    int node;
    FBT_INT_EQ(fb_shape_add_node(&shape, &node, end, NULL, NULL), FB_OK);
    input.load[k].node = node;
    input.load[k].force[0] = (fb_real)(k ? -F : F);
    drive.load[k].load = input.load[k];
  }
  input.n_load = drive.n_load = 2;
  FBT_INT_EQ(fb_body_init(&part[0], &body_work, &shape, &level), FB_OK);
  FBT_INT_EQ(fb_state_init(&part[0], &state), FB_OK);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND);
  build();
  for (int system = 0; system < 2; system++) {
    int swings = 0;
    if (system) {
      FBT_INT_EQ(fb_system_spectrum_solve(&mechanism, part, &tree_work, &spectrum, &tree_state, &drive), FB_OK);
    } else {
      FBT_INT_EQ(fb_body_spectrum_solve(&part[0], &work, &spectrum, &state, &input), FB_OK);
    }
    for (int k = 0; k < spectrum.n; k++) {
      if (spectrum.im[k] > FB_R(0.1)) { /* the others drift */
        FBT_NEAR_REL(spectrum.im[k], sqrt(2.0 * F * l / (swings ? J_y : J_z)), FBT_TOL(1e-9, 1e-3));
        swings++;
      }
    }
    FBT_INT_EQ(swings, 2);
  }
}

/* E12.8, E12.10: a flexible body that floats is a system of one: at rest and spinning the same steady shape and the
   same complex modes as by E12.1 and E12.3, number and shapes included. */
TEST(a_free_body_is_a_system_of_one)
{
  for (int run = 0; run < 12;
       run++) { /* the joint is prescribed and then freed, or free at once, at rest or in flight */
    static fb_spectrum own;
    const int freed = run < 4;
    fb_state state;
    fb_motion motion;
    fb_input input;
    int common = 0;
    memset(&input, 0, sizeof input);
    input.w[2] = (fb_real)(1.5 * (run % 4));
    fresh();
    flexible_part(0, 2.0, 2, FB_BASE_FREE, FB_EFFECTS_FULL | FB_EFFECT_DAMPING);
    FBT_INT_EQ(fb_state_init(&part[0], &state), FB_OK);
    FBT_INT_EQ(fb_body_trim(&part[0], &state, &work, &input), FB_OK);
    FBT_INT_EQ(fb_body_spectrum_solve(&part[0], &work, &own, &state, &input), FB_OK);
    FBT_INT_EQ(fb_body_motion_eval(&part[0], &motion, &state, &input), FB_OK);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND)->mode[0] = freed ? FB_AXIS_PRESCRIBED : FB_AXIS_FREE;
    frame_turn(start[0].quat, 0.3, -0.5, 0.2);
    for (int i = 0; i < 3; i++) {
      start[0].speed[i] = run < 8 ? FB_R(0.0) : FB_R(0.7) * (fb_real)(i + 1);
      drive.drive[0].rate[i] = freed ? motion.v[i] : FB_R(0.0);
      drive.drive[0].rate[3 + i] = freed ? motion.w[i] : input.w[i];
    }
    build();
    FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), FB_OK);
    FBT_NEAR_ABS(fbt_largest(tree_state.link[0].q, 4), 0.0, FBT_TOL(1e-12, 1e-5)); /* spin does not bend it */
    FBT_NEAR_ABS(fbt_largest(state.q, 4), 0.0, FBT_TOL(1e-12, 1e-5));
    FBT_INT_EQ(fb_system_axis_set(&mechanism, part, &tree_state, &tree_work.system, 0, 0, FB_AXIS_FREE, &drive), FB_OK);
    FBT_INT_EQ(fb_system_spectrum_solve(&mechanism, part, &tree_work, &spectrum, &tree_state, &drive), FB_OK);
    for (int i = 0; i < own.n; i++) {
      const double re = (double)own.re[i], im = (double)own.im[i];
      double miss = 1.0;
      int at = 0;
      if (hypot(re, im) < 0.05) { /* what drifts is zero to a root of rounding */
        continue;
      }
      for (int k = 0; k < spectrum.n; k++) {
        const double d = hypot((double)spectrum.re[k] - re, (double)spectrum.im[k] - im) / hypot(re, im);
        at = d < miss ? k : at;
        miss = fmin(d, miss);
      }
      FBT_BELOW(miss, FBT_TOL(1e-9, 3e-3));
      common++;
      if (im > 5.0) { /* a mode of vibration: q_a of both in the same ratio */
        int most = 0;
        for (int a = 1; a < 4; a++) {
          most = hypot((double)own.shape_re[4 * i + a], (double)own.shape_im[4 * i + a]) >
                         hypot((double)own.shape_re[4 * i + most], (double)own.shape_im[4 * i + most])
                     ? a
                     : most;
        }
        for (int a = 0; a < 4; a++) { /* x_a y_most = y_a x_most */
          const int A = 4 * i + a, A0 = 4 * i + most, B = 10 * at + 6 + a, B0 = 10 * at + 6 + most;
          const number x = {(double)own.shape_re[A], (double)own.shape_im[A]};
          const number x0 = {(double)own.shape_re[A0], (double)own.shape_im[A0]};
          const number y = {(double)spectrum.shape_re[B], (double)spectrum.shape_im[B]};
          const number y0 = {(double)spectrum.shape_re[B0], (double)spectrum.shape_im[B0]};
          const number d = plus(times(x, y0), -1.0, times(y, x0));
          FBT_BELOW(hypot(d.re, d.im) / (hypot(x0.re, x0.im) * hypot(y0.re, y0.im)), FBT_TOL(1e-8, 1e-2));
        }
      }
      for (int a = 0; a < 6; a++) { /* the pose is left out */
        FBT_NEAR_ABS(spectrum.shape_re[10 * at + a], 0.0, 0.0);
      }
    }
    FBT_TRUE(common >= 4);
    if (run % 4 > 0) { /* at rest pairs of zeros may split either way */
      FBT_INT_EQ(spectrum.n, own.n);
    }
  }
}

/* E12.8, E12.9: a base that is driven around a circle bends and rings as a body on a prescribed base does, whatever the
   velocity of the frame that its momenta are against: from the trim, or a state that was set up as it is. */
TEST(a_driven_base_is_a_system_of_one)
{
  static fb_spectrum own;
  static const fb_real v[3] = {FB_R(3.0), FB_R(20.0), -FB_R(4.0)}, w[3] = {0, FB_R(0.4), FB_R(2.0)};
  for (int run = 0; run < 2; run++) {
    fb_state state;
    fb_input input;
    memset(&input, 0, sizeof input);
    memcpy(input.v, v, sizeof v);
    memcpy(input.w, w, sizeof w);
    fresh();
    flexible_part(0, 2.0, 2, FB_BASE_PRESCRIBED, FB_EFFECTS_FULL | FB_EFFECT_DAMPING);
    FBT_INT_EQ(fb_state_init(&part[0], &state), FB_OK);
    FBT_INT_EQ(fb_body_trim(&part[0], &state, &work, &input), FB_OK);
    FBT_INT_EQ(fb_body_spectrum_solve(&part[0], &work, &own, &state, &input), FB_OK);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND)->mode[0] = FB_AXIS_PRESCRIBED;
    frame_turn(start[0].quat, 0.3, -0.5, 0.2);
    memcpy(start[0].q, state.q, sizeof start[0].q);
    memcpy(drive.drive[0].rate, v, sizeof v);
    memcpy(drive.drive[0].rate + 3, w, sizeof w);
    build();
    if (run == 0) {
      FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), FB_OK);
    }
    FBT_BELOW(fbt_difference(tree_state.link[0].q, state.q, 4), FBT_TOL(1e-10, 1e-5));
    FBT_INT_EQ(fb_system_spectrum_solve(&mechanism, part, &tree_work, &spectrum, &tree_state, &drive), FB_OK);
    FBT_INT_EQ(spectrum.n, own.n);
    for (int i = 0; i < own.n && i < spectrum.n; i++) {
      FBT_NEAR_ABS(spectrum.re[i], own.re[i], FBT_TOL(1e-8, 3e-3) * fabs((double)own.im[i]));
      FBT_NEAR_REL(spectrum.im[i], own.im[i], FBT_TOL(1e-8, 3e-3));
    }
  }
}

/* E12.2, E12.9: a top that sleeps upright: in axes that do not spin its tilt goes as exp(i n t) with A n^2 - C s n + m
   g l = 0, in its own as exp(i (n - s) t); below the spin s at which n is real it falls. As a body on a pin and as a
   system with a ball joint, axes and attitude turned anyhow. */
TEST(sleeping_tops_tilt_in_closed_form)
{
  for (int run = 0; run < 10; run++) {
    const int single = run % 2;
    const double s = 4.0 + 3.0 * (run / 2), m = 2.0, l = 0.3, g = 9.81, A = 0.4, C = 0.15;
    const double square = C * C * s * s - 4.0 * A * m * g * l, mean = C * s / (2.0 * A) - s;
    const double size = sqrt(fabs(square)) / (2.0 * A);
    const fb_real center[3] = {0, 0, (fb_real)l};
    const fb_real J[6] = {(fb_real)(A - m * l * l), (fb_real)(A - m * l * l), (fb_real)C, 0, 0, 0};
    static fb_body_desc desc;
    double found[2] = {0, 0};
    memset(&desc, 0, sizeof desc);
    desc.base = single ? FB_BASE_PINNED : FB_BASE_PRESCRIBED;
    desc.effects = FB_EFFECT_GRAVITY;
    desc.gravity[2] = -(fb_real)g;
    FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)m, center, J), FB_OK);
    FBT_INT_EQ(fb_body_init(&part[0], &body_work, &shape, &desc), FB_OK);
    if (single) {
      const fb_real v[3] = {0}, w[3] = {0, 0, (fb_real)s};
      fb_input input;
      fb_state state;
      memset(&input, 0, sizeof input);
      FBT_INT_EQ(fb_state_init(&part[0], &state), FB_OK);
      frame_turn(state.quat, 0.0, 0.0, 0.9);
      FBT_INT_EQ(fb_state_from_velocity(&part[0], &state, v, w, NULL), FB_OK);
      FBT_INT_EQ(fb_body_spectrum_solve(&part[0], &work, &spectrum, &state, &input), FB_OK);
    } else { /* R = attitude quat child_attitude^T = 1; speeds about the child's joint axes */
      fb_joint_desc *j;
      fb_real R[9];
      const fb_real w[3] = {0, 0, (fb_real)s};
      fresh();
      j = hang(0, 0, FB_JOINT_SPHERICAL, FB_GROUND);
      frame_turn(j->attitude, 0.4, -0.3, 0.8);
      frame_turn(j->child_attitude, -0.2, 0.9, 0.1);
      start[0].quat[0] = j->attitude[0];
      for (int i = 1; i < 4; i++) {
        start[0].quat[i] = -j->attitude[i];
      }
      {
        fb_real inverse[4];
        memcpy(inverse, start[0].quat, sizeof inverse);
        fb_quat_mul(start[0].quat, inverse, j->child_attitude);
      }
      fb_quat_to_mat33(R, j->child_attitude);
      fb_mat33_mulT_vec3(start[0].speed, R, w);
      build();
      FBT_INT_EQ(fb_system_spectrum_solve(&mechanism, part, &tree_work, &spectrum, &tree_state, &drive), FB_OK);
    }
    for (int k = 0; k < spectrum.n; k++) {
      for (int side = 0; side < 2; side++) {
        const double sign = side ? -1.0 : 1.0;
        const double re = square < 0.0 ? sign * size : 0.0, im = fabs(mean + (square < 0.0 ? 0.0 : sign * size));
        found[side] += hypot((double)spectrum.re[k] - re, (double)spectrum.im[k] - im) < FBT_TOL(1e-8, 1e-2);
      }
    }
    FBT_NEAR_ABS(found[0], 1.0, 0.0);
    FBT_NEAR_ABS(found[1], 1.0, 0.0);
  }
}

/* ---- a disk (4 kg, with the radii of gyration 0.15 m and 0.112 m on 0.6 m) that spins at the tip of a clamped
   shaft */

/* The mode of the spectrum whose frequency is nearest. */
static int nearest_mode(double want)
{
  int at = 0;
  for (int k = 1; k < spectrum.n; k++) {
    at = fabs((double)spectrum.im[k] - want) < fabs((double)spectrum.im[at] - want) ? k : at;
  }
  return at;
}

/* E12.9, E12.10, E12.12, E12.16: a disk that spins on a light shaft whirls forward and back at the roots of (k11 - m
   l^2) (k22 - Id l^2 + Ip s l) = k12^2, and nothing grows: shafts of 6 cm to 6 m and of a tenth to a ten thousandth of
   the disk's mass, spins from 0 to 600 rad/s. The shaft's own mass is worth at most its part of the disk's. The rest is
   within the errors that the spectrum tells, and these are small. */
TEST(shafts_with_disks_whirl_in_closed_form)
{
  double largest = 0.0;
  for (int run = 0; run < 72; run++) {
    const double length = 0.06 * pow(10.0, run % 3), disk = 4.0, shaft = 0.4 * pow(10.0, -(run / 3 % 4));
    const double spin = 120.0 * (run % 6);
    const int natural = run / 12 % FBT_TOL(6, 1);
    double want[4];
    FBT_TRUE(shaft_with_disk(length, shaft, disk, spin, natural));
    whirls(want, length, disk, spin);
    FBT_INT_EQ(fb_system_spectrum_solve(&mechanism, part, &tree_work, &spectrum, &tree_state, &drive), FB_OK);
    FBT_BELOW((double)tree_work.common.linear.error, FBT_TOL(1e-10, 1e-3));
    FBT_TRUE(spectrum.n >= 6 + 2 * natural); /* the disk's angle is free: a pair of zeros may split either way */
    for (int k = 0; k < spectrum.n; k++) {
      FBT_BELOW(fabs((double)spectrum.re[k]), 20.0 * (double)spectrum.error[k]);
    }
    for (int i = 0; i < 4; i++) {
      const int k = nearest_mode(want[i]);
      const double error = (double)spectrum.error[k] / want[i], miss = fabs((double)spectrum.im[k] / want[i] - 1.0);
      FBT_BELOW(error, FBT_TOL(1e-5, 1e-2));
      FBT_BELOW(miss, shaft / disk + 4.0 * error);
      largest = shaft < 1e-3 ? fmax(largest, miss) : largest;
    }
  }
  fbt_figure("disk on a shaft of a ten thousandth of its mass, four whirls", "closed form", largest);
}

/* E12.2, E12.9: the pose of a free body against a frame that goes on with v, w: r' = -w x r - v x theta + .., theta' =
   -w x theta + .., whatever the attitude; as a body and as a system of one. */
TEST(poses_drift_as_the_frame_goes_on)
{
  static fb_linear linear;
  const fb_real w[3] = {FB_R(0.7), FB_R(1.1), -FB_R(0.4)};
  fb_real v[3] = {FB_R(0.5), -FB_R(0.3), FB_R(0.8)}, u[3], R[9];
  fb_state state;
  fb_input input;
  memset(&input, 0, sizeof input);
  fresh();
  flexible_part(0, 2.0, 1, FB_BASE_FREE, FB_EFFECTS_FULL);
  FBT_INT_EQ(fb_state_init(&part[0], &state), FB_OK);
  frame_turn(state.quat, 0.3, -0.8, 0.5);
  state.rho[0] = FB_R(2.0);
  FBT_INT_EQ(fb_state_from_velocity(&part[0], &state, v, w, NULL), FB_OK);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND);
  memcpy(start[0].quat, state.quat, sizeof state.quat);
  memcpy(start[0].value, state.rho, sizeof state.rho);
  memcpy(start[0].speed, v, sizeof v);
  memcpy(start[0].speed + 3, w, sizeof w);
  build();
  for (int system = 0; system < 2; system++) {
    const int at = system ? 0 : 10;
    if (system) {
      FBT_INT_EQ(fb_system_linearize(&mechanism, part, &tree_work, &linear, &tree_state, &drive, NULL), FB_OK);
      fb_quat_to_mat33(R, state.quat); /* momenta, and what turns with them, are relative to the frame of the state */
      fb_mat33_mulT_vec3(u, R, tree_state.link[0].u);
      for (int i = 0; i < 3; i++) {
        FBT_TRUE(fabs((double)u[i]) > 0.0);
        v[i] -= u[i];
      }
    } else {
      FBT_INT_EQ(fb_body_linearize(&part[0], &work, &linear, &state, &input, NULL), FB_OK);
    }
    FBT_INT_EQ(linear.n, 16);
    for (int j = 0; j < 3; j++) {
      fb_real unit[3] = {0, 0, 0}, turn[3], shift[3];
      unit[j] = FB_R(1.0);
      fb_vec3_cross(turn, unit, w);
      fb_vec3_cross(shift, unit, v);
      for (int i = 0; i < 3; i++) {
        FBT_NEAR_ABS(linear.A[(at + i) * 16 + at + j], turn[i], FBT_TOL(1e-11, 1e-4));
        FBT_NEAR_ABS(linear.A[(at + i) * 16 + at + 3 + j], shift[i], FBT_TOL(1e-11, 1e-4));
        FBT_NEAR_ABS(linear.A[(at + 3 + i) * 16 + at + 3 + j], turn[i], FBT_TOL(1e-11, 1e-4));
      }
    }
  }
}

/* E12.9: the linear model of a spinning spacecraft, integrated, answers to small torques, forces and turns of a given
   base as the system does: joint coordinates and speeds, gyros, deflections and an accelerometer. */
TEST(linear_models_answer_as_the_system_does)
{
  static const fb_port out[8] = {
      {FB_PORT_COORDINATE, 1, 0, 0, FB_AXES_BODY},   {FB_PORT_SPEED, 2, 0, 0, FB_AXES_BODY},
      {FB_PORT_COORDINATE, 3, 0, 1, FB_AXES_BODY},   {FB_PORT_SPEED, 3, 0, 2, FB_AXES_BODY},
      {FB_PORT_RATE, 3, 1, 1, FB_AXES_BODY},         {FB_PORT_DISPLACEMENT, 2, 1, 2, FB_AXES_BODY},
      {FB_PORT_ACCELERATION, 2, 1, 2, FB_AXES_BODY}, {FB_PORT_ROTATION, 1, 1, 2, FB_AXES_BODY}};
  const double small = FBT_TOL(1e-3, 3e-2);
  for (int base = 0; base < 2; base++) {
    const fb_port in[5] = {{base ? FB_PORT_BASE_RATE : FB_PORT_TORQUE, 0, 0, 0, FB_AXES_BODY},
                           {FB_PORT_DRIVE, 1, 0, 0, FB_AXES_BODY},
                           {FB_PORT_DRIVE, 3, 0, 1, FB_AXES_BODY},
                           {FB_PORT_FORCE, 2, 1, 2, FB_AXES_BODY},
                           {base ? FB_PORT_BASE_VELOCITY : FB_PORT_FORCE, 0, 0, 1, FB_AXES_BODY}};
    const double size[5] = {base ? 0.02 * small : small, small, small, small, base ? 0.2 * small : small};
    const int n_free = base ? 5 : 11;
    spinner(base ? FB_AXIS_PRESCRIBED : FB_AXIS_FREE, 0.8);
    build();
    FBT_BELOW(answers_apart(in, out, size, 4 + n_free, n_free), FBT_TOL(5e-4, 1.5e-2));
  }
}

/* A free hub that spins about z, off its mass center, with a flexible blade on a sprung hinge, a body on a slide out
   along x and one on a sprung ball joint, in units of u meters and m kilograms: its linear model about the trimmed
   state, and in size those of x, of the inputs and of the outputs. */
static void system_in_units(fb_linear *linear, double size[3][FB_MAX_LINEAR], double u, double m)
{
  static const fb_linear_desc ports = {4,
                                       6,
                                       {{FB_PORT_FORCE, 1, 1, 1, FB_AXES_BODY},
                                        {FB_PORT_TORQUE, 0, 0, 2, FB_AXES_BODY},
                                        {FB_PORT_DRIVE, 1, 0, 0, FB_AXES_BODY},
                                        {FB_PORT_DRIVE, 2, 0, 0, FB_AXES_BODY}},
                                       {{FB_PORT_COORDINATE, 2, 0, 0, FB_AXES_BODY},
                                        {FB_PORT_SPEED, 2, 0, 0, FB_AXES_BODY},
                                        {FB_PORT_SPEED, 3, 0, 1, FB_AXES_BODY},
                                        {FB_PORT_DISPLACEMENT, 1, 1, 2, FB_AXES_BODY},
                                        {FB_PORT_RATE, 3, 1, 0, FB_AXES_BODY},
                                        {FB_PORT_ACCELERATION, 0, 1, 1, FB_AXES_BODY}}};
  const double J = m * u * u, in[4] = {m * u, J, J, m * u}, out[6] = {u, u, 1.0, u, 1.0, u}, mode = u * sqrt(m);
  const double z[13] = {u, u, u, 1.0, 1.0, 1.0, 1.0, u, 1.0, 1.0, 1.0, mode, mode};
  const fb_real center[3] = {(fb_real)(0.1 * u), 0, 0},
                own[6] = {(fb_real)(0.8 * J), (fb_real)(0.5 * J), (fb_real)(0.9 * J)};
  fb_joint_desc *j;
  fresh();
  rigid_part(0, 8.0 * m, 0.1 * u, 3.0 * J, 4.0 * J, 6.0 * J, 0.0);
  uniform_line(2.0 * u, 6, 0.5 * m / u, 40.0 * J * u, 60.0 * J * u, 1);
  level.effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING;
  level.base = FB_BASE_PRESCRIBED;
  level.zeta[0] = FB_R(0.02);
  beam_body(&part[1], 2.0 * m, center, own);
  rigid_part(2, m, 0.4 * u, 0.1 * J, 0.35 * J, 0.3 * J, 0.0);
  (void)hang(0, 0, FB_JOINT_FREE, FB_GROUND);
  for (int k = 1; k < 4; k++) {
    j = hang(k, k == 1 ? 1 : 2, k == 1 ? FB_JOINT_REVOLUTE : k == 2 ? FB_JOINT_PRISMATIC : FB_JOINT_SPHERICAL, 0);
    j->position[k - 1] = (fb_real)(0.5 * u);
    j->stiffness[0] = (fb_real)(k == 2 ? 200.0 * m : 30.0 * J);
    j->damping[0] = (fb_real)(k == 2 ? 3.0 * m : 0.5 * J);
    frame_turn(j->attitude, 0.2 * k, k == 2 ? pi / 2 : -0.1 * k, 0.3);
  }
  drive.drive[0].rate[5] = FB_R(0.8);
  build();
  FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), FB_OK);
  FBT_INT_EQ(fb_system_linearize(&mechanism, part, &tree_work, linear, &tree_state, &drive, &ports), FB_OK);
  FBT_INT_EQ(linear->n, 26);
  for (int i = 0; i < 13; i++) {
    size[0][i] = z[i];
    size[0][13 + i] = J / z[i];
  }
  memcpy(size[1], in, sizeof in);
  memcpy(size[2], out, sizeof out);
}

/* E12.8, E12.9: the linear model of a system, too, is the same in every unit of length and of mass. */
TEST(linear_models_of_systems_do_not_depend_on_units)
{
  static fb_linear one, other;
  static double size[3][FB_MAX_LINEAR], same[3][FB_MAX_LINEAR];
  system_in_units(&one, same, 1.0, 1.0);
  for (int large = 0; large < 2; large++) {
    const double tol = FBT_TOL(1e-11, 1e-3);
    system_in_units(&other, size, large ? FBT_TOL(1e3, 1e2) : FBT_TOL(1e-3, 1e-2), large ? 0.125 : 8.0);
    FBT_BELOW(units_apart(other.A, one.A, size[0], size[0], 26, 26), tol);
    FBT_BELOW(units_apart(other.C, one.C, size[2], size[0], one.n_out, 26), tol);
    FBT_BELOW(units_apart(other.B, one.B, size[0], size[1], 26, one.n_in), tol);
    FBT_BELOW(units_apart(other.D, one.D, size[2], size[1], one.n_out, one.n_in), tol);
  }
}

/* E12.2, E12.9: a base that flies and spins fast: the acceleration w x v of its node has the derivatives w by v and v
   by w; of a body and of a system of one. */
TEST(fast_bases_have_linear_models)
{
  static const fb_linear_desc ports = {
      2,
      1,
      {{FB_PORT_BASE_VELOCITY, 0, 0, 0, FB_AXES_BODY}, {FB_PORT_BASE_RATE, 0, 0, 2, FB_AXES_BODY}},
      {{FB_PORT_ACCELERATION, 0, 0, 1, FB_AXES_BODY}}};
  static fb_linear linear;
  for (int k = 0; k < 4; k++) {
    const fb_real v[3] = {k % 2 ? FB_R(1e6) : FB_R(1.0), 0, 0}, w[3] = {0, 0, k % 2 ? FB_R(0.5) : FB_R(1e6)};
    fresh();
    flexible_part(0, 2.0, 1, FB_BASE_PRESCRIBED, FB_EFFECTS_LINEAR);
    if (k < 2) {
      fb_state state;
      fb_input input;
      memset(&input, 0, sizeof input);
      memcpy(input.v, v, sizeof v);
      memcpy(input.w, w, sizeof w);
      FBT_INT_EQ(fb_state_init(&part[0], &state), FB_OK);
      FBT_INT_EQ(fb_body_linearize(&part[0], &work, &linear, &state, &input, &ports), FB_OK);
    } else {
      hang(0, 0, FB_JOINT_FREE, FB_GROUND)->mode[0] = FB_AXIS_PRESCRIBED;
      memcpy(drive.drive[0].rate, v, sizeof v);
      memcpy(drive.drive[0].rate + 3, w, sizeof w);
      build();
      FBT_INT_EQ(fb_system_linearize(&mechanism, part, &tree_work, &linear, &tree_state, &drive, &ports), FB_OK);
    }
    FBT_NEAR_REL(linear.D[0], w[2], FBT_TOL(1e-13, 1e-5));
    FBT_NEAR_REL(linear.D[1], v[0], FBT_TOL(1e-13, 1e-5));
  }
}

/* E12.9: a motor that pulls hard, on a hinge or a slide: its effort is the momentum's rate, a torque or force more that
   much more of it. */
TEST(motors_that_pull_have_linear_models)
{
  static const fb_linear_desc ports = {
      1, 0, {{FB_PORT_DRIVE, 0, 0, 0, FB_AXES_BODY}}, {{FB_PORT_FORCE, 0, 0, 0, FB_AXES_BODY}}};
  static fb_linear linear;
  for (int k = 0; k < 2; k++) {
    fresh();
    rigid_part(0, 2.0, 0.1, 0.5, 0.5, 0.5, 0.0);
    hang(0, 0, k ? FB_JOINT_PRISMATIC : FB_JOINT_REVOLUTE, FB_GROUND);
    drive.drive[0].torque[0] = FB_R(-1e7);
    build();
    FBT_INT_EQ(fb_system_linearize(&mechanism, part, &tree_work, &linear, &tree_state, &drive, &ports), FB_OK);
    FBT_NEAR_ABS(linear.B[1], 1.0, FBT_TOL(1e-14, 1e-5));
    FBT_NEAR_ABS(linear.rate[0], 0.0, 1e-6);
    FBT_NEAR_REL(linear.rate[1], -1e7, FBT_TOL(1e-14, 1e-5));
  }
}

/* E12.9, E12.10: a pendulum and a top have their closed forms whatever the unit of time, and force, speed and rate of
   turn as inputs their derivatives: steps are those of what moves, not of a second. */
TEST(linear_models_follow_the_unit_of_time)
{
  static const fb_linear_desc motor = {
      1, 0, {{FB_PORT_DRIVE, 0, 0, 0, FB_AXES_BODY}}, {{FB_PORT_FORCE, 0, 0, 0, FB_AXES_BODY}}};
  static fb_linear linear;
  for (int run = 0; run < 5; run++) {
    const double rate = pow(10.0, FBT_TOL(10.0, 3.0) * (run - 2)), tol = FBT_TOL(1e-11, 1e-4);
    const double m = 2.0, c = 0.3, J = 0.5, w = rate * sqrt(m * 9.81 * c / J), s = 3.0 * rate;
    const fb_real center[3] = {0}, inertia[6] = {FB_R(1.0), FB_R(1.0), FB_R(1.5), 0, 0, 0};
    const fb_real still[3] = {0}, turn[3] = {0, 0, (fb_real)s};
    double nutation = HUGE_VAL;
    fb_body_desc free_body;
    fb_state state;
    fb_input input;
    fresh();
    rigid_part(0, m, c, 0.1, J, J, 9.81 * rate * rate); /* gravity along x */
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND);
    build();
    FBT_INT_EQ(fb_system_linearize(&mechanism, part, &tree_work, &linear, &tree_state, &drive, &motor), FB_OK);
    FBT_NEAR_REL(linear.B[1], 1.0, tol);
    FBT_NEAR_REL(linear.A[1], 1.0 / J, tol);
    FBT_NEAR_REL(linear.A[2], -m * 9.81 * c * rate * rate, tol);
    FBT_NEAR_ABS(linear.A[0], 0.0, tol * w);
    FBT_NEAR_ABS(linear.A[3], 0.0, tol * w);
    memset(&free_body, 0, sizeof free_body);
    FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)m, center, inertia), FB_OK);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &free_body), FB_OK);
    memset(&input, 0, sizeof input);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    frame_turn(state.quat, 0.4, -0.3, 0.8);
    FBT_INT_EQ(fb_state_from_velocity(&body, &state, still, turn, NULL), FB_OK);
    FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, &spectrum, &state, &input), FB_OK);
    for (int k = 0; k < spectrum.n; k++) { /* (C/A - 1) s */
      nutation = fmin(nutation, hypot((double)spectrum.re[k], (double)spectrum.im[k] - 0.5 * s) / s);
    }
    FBT_BELOW(nutation, tol);
  }
}

/* E12.9: a system with as many speeds, inputs and outputs as there is room for has a linear model: the torque of an
   axis is the rate of the momentum conjugate to it and of nothing else, what a coordinate reads is that coordinate. */
TEST(full_systems_have_linear_models)
{
  static const fb_joint_kind kinds[7] = {FB_JOINT_FREE,      FB_JOINT_REVOLUTE,  FB_JOINT_REVOLUTE, FB_JOINT_REVOLUTE,
                                         FB_JOINT_SPHERICAL, FB_JOINT_SPHERICAL, FB_JOINT_PRISMATIC};
  static fb_linear linear;
  static fb_linear_desc ports;
  int at = 6, place[FB_MAX_PORTS];
  fresh();
  flexible_part(0, 2.0, 6, FB_BASE_PRESCRIBED, FB_EFFECTS_FULL);
  rigid_part(1, 1.0, 0.4, 0.1, 0.35, 0.3, 0.0);
  ports.n_in = ports.n_out = FB_MAX_PORTS;
  for (int k = 0, port = 0; k < 7; k++) {
    const int n_axis = k == 0 ? 0 : kinds[k] == FB_JOINT_SPHERICAL ? 3 : 1;
    fb_joint_desc *const j = hang(k, k < 4 ? 0 : 1, kinds[k], k == 0 ? FB_GROUND : 0);
    j->position[1] = FB_R(0.3) * (fb_real)k;
    for (int i = 0; i < n_axis; i++, port++, at++) {
      const fb_port drive_port = {FB_PORT_DRIVE, k, 0, i, FB_AXES_BODY},
                    read_port = {FB_PORT_COORDINATE, k, 0, i, FB_AXES_BODY};
      ports.in[port] = drive_port;
      ports.out[port] = read_port;
      place[port] = at;
    }
  }
  for (int port = 10; port < FB_MAX_PORTS; port++) { /* the rest */
    const fb_port push = {FB_PORT_FORCE, 0, 1, port - 10, FB_AXES_BODY},
                  read = {FB_PORT_RATE, 0, 1, port - 10, FB_AXES_BODY};
    ports.in[port] = push;
    ports.out[port] = read;
  }
  FBT_INT_EQ(at + 4 * part[0].n, FB_MAX_SPEEDS);
  build();
  FBT_INT_EQ(fb_system_linearize(&mechanism, part, &tree_work, &linear, &tree_state, &drive, &ports), FB_OK);
  FBT_INT_EQ(linear.n, FB_MAX_LINEAR);
  for (int port = 0; port < 10; port++) {
    for (int i = 0; i < FB_MAX_LINEAR; i++) {
      FBT_NEAR_ABS(linear.B[i * FB_MAX_PORTS + port], i == FB_MAX_SPEEDS + place[port], FBT_TOL(1e-9, 1e-3));
      FBT_NEAR_ABS(linear.C[port * FB_MAX_LINEAR + i], i == place[port], FBT_TOL(1e-9, 1e-3));
    }
  }
}

/* E12.8: two free bodies on a sprung slide, pulled apart by F, rest with the spring F/k longer, however they are
   turned: what pushes each is much, what pushes both is nothing. One of the pulls alone is no rest. */
TEST(pulled_apart_free_bodies_rest)
{
  for (int run = 0; run < 6; run++) {
    const double k = 50.0, F = 4.0;
    fb_joint_desc *slide;
    fresh();
    rigid_part(0, 3.0, 0.0, 0.5, 0.6, 0.7, 0.0);
    rigid_part(1, 2.0, 0.0, 0.3, 0.4, 0.2, 0.0);
    (void)hang(0, 0, FB_JOINT_FREE, FB_GROUND);
    slide = hang(1, 1, FB_JOINT_PRISMATIC, 0);
    slide->stiffness[0] = (fb_real)k;
    frame_turn(start[0].quat, 0.3 * run, -0.5, 0.2 * run);
    drive.n_load = run < 5 ? 2 : 1;
    for (int i = 0; i < 2; i++) {
      drive.load[i].body = i;
      drive.load[i].load.axes = FB_AXES_BODY;
      drive.load[i].load.force[2] = (fb_real)(i ? F : -F);
    }
    build();
    FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), run < 5 ? FB_OK : FB_ERR_UNREST);
    FBT_TRUE(run == 5 || fabs((double)tree_state.link[1].x[0] - F / k) < FBT_TOL(1e-12, 1e-6));
  }
}

SUITE(analyse_system, RUN(pulled_apart_free_bodies_rest), RUN(linear_models_of_systems_do_not_depend_on_units),
      RUN(fast_bases_have_linear_models), RUN(motors_that_pull_have_linear_models),
      RUN(full_systems_have_linear_models), RUN(hinged_blades_flap_and_lag_in_closed_form),
      RUN(blades_cone_under_a_moment), RUN(axes_that_move_on_end_what_is_steady),
      RUN(bases_that_are_pushed_have_no_state_of_rest), RUN(double_pendulum_swings_in_closed_form),
      RUN(a_free_body_is_a_system_of_one), RUN(a_driven_base_is_a_system_of_one), RUN(opposite_pulls_hold_a_free_body),
      RUN(sleeping_tops_tilt_in_closed_form), RUN(shafts_with_disks_whirl_in_closed_form),
      RUN(linear_models_follow_the_unit_of_time), RUN(poses_drift_as_the_frame_goes_on),
      RUN(linear_models_answer_as_the_system_does))
