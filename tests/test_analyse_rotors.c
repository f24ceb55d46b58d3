/* >>trim and >>linear: rotors: steady states, linear models and spectra of bodies with wheels inside, about any speeds of
   the wheels. Closed forms of gyrostats, differences of the rates themselves. */
#include "rotors.h"
#if FB_WITH_ROTORS

static fb_analyse_work work;
static fb_linear linear;
static fb_linear_desc ports;
static fb_spectrum spectrum;
static fb_rk4_work rk4;

static void trim_at(double x, double y, double z)
{
  input.w[0] = (fb_real)x;
  input.w[1] = (fb_real)y;
  input.w[2] = (fb_real)z;
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_OK);
  FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &input), FB_OK);
}

/* Is re + i im among the eigenvalues? */
static void among(double re, double im, double tolerance)
{
  double nearest = 1e9;
  for (int k = 0; k < spectrum.n; k++) {
    nearest = fmin(nearest, hypot((double)spectrum.re[k] - re, (double)spectrum.im[k] - im));
  }
  FBT_NEAR_ABS(nearest, 0.0, tolerance);
}

/* ---- closed forms */

/* E8.47: a platform that turns at W about y, along which its wheel has the momentum h, nutates with
   lambda^2 = -(h + (J_y - J_z) W)(h + (J_y - J_x) W)/(J_x J_z): at rest h/sqrt(J_x J_z), roll against yaw of a
   satellite with a momentum wheel along pitch. Where the product is negative it tumbles. */
TEST(momentum_wheels_give_their_platform_a_nutation)
{
  const double J[3] = {2.0, 3.0, 4.5}, h = 0.8, I = 0.01;
  for (int run = 0; run < 4; run++) {
    const double W = run == 0 ? 0.0 : run == 1 ? 0.3 : run == 2 ? -0.2 : 1.0, sign = run == 3 ? -1.0 : 1.0;
    const double a = sign * h + (J[1] - J[2]) * W, b = sign * h + (J[1] - J[0]) * W, square = a * b / (J[0] * J[2]);
    const double speed = sign * h / I;
    fresh(FB_BASE_FREE, 0);
    rotor_add(0, 0, 1, 0, I);
    rigid_hub(50.0, 0.0, J[0], J[1], J[2]);
    spin_up(0, 0, 0, &speed);
    trim_at(0, W, 0);
    FBT_NEAR_ABS(motion.w[1], W, FBT_TOL(1e-13, 1e-6));
    FBT_NEAR_REL(motion.rotor_momentum[0], sign * h, FBT_TOL(1e-13, 1e-6));
    FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, &spectrum, &state, &input), FB_OK);
    FBT_TRUE((square > 0.0) == (run != 3));
    among(square > 0.0 ? 0.0 : sqrt(-square), square > 0.0 ? sqrt(square) : 0.0, FBT_TOL(1e-7, 1e-3));
  }
}

#if FB_WITH_SYSTEM
/* The same body on a free joint, anyhow turned, its wheels at these speeds: a state of rest. */
static void system_rests(const double *speed)
{
  static fb_system_desc tree;
  static fb_system system;
  static fb_system_work scratch;
  static fb_system_analyse_work analyse;
  static fb_system_state at;
  static fb_system_input still;
  static fb_link_motion first[FB_MAX_BODIES];
  fb_real turn[3];
  for (int i = 0; i < 3; i++) {
    turn[i] = (fb_real)fbt_random();
    first[0].rotor_speed[i] = (fb_real)speed[i];
  }
  fb_quat_from_rotvec(first[0].quat, turn);
  tree.n_body = 1;
  tree.joint[0].kind = FB_JOINT_FREE;
  tree.joint[0].parent = FB_GROUND;
  FBT_INT_EQ(fb_system_init(&system, &scratch, &body, &tree, 1), FB_OK);
  FBT_INT_EQ(fb_system_state_init(&system, &body, &at, &scratch, first, &still), FB_OK);
  FBT_INT_EQ(fb_system_trim(&system, &body, &at, &analyse, &still), FB_OK);
}
#endif

/* E8.47 at rest: whatever the wheels do and however the craft is turned, it has a state of rest. What the rounding of
   their momenta leaves of the angular velocity is no spin. */
TEST(wheels_at_any_speeds_leave_a_craft_at_rest)
{
  static const fb_base base[] = {FB_BASE_FREE, FB_BASE_PINNED};
  fbt_seed(11);
  for (int k = 0; k < 40; k++) {
    double speed[3];
    for (int r = 0; r < 3; r++) {
      speed[r] = 400.0 * fbt_random();
    }
    craft(FB_EFFECTS_FULL, base[k % 2], 0);
    spin_up(0, 0, 0, speed);
    trim_at(0, 0, 0);
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(motion.w[i], 0.0, FBT_TOL(1e-12, 1e-3));
    }
#if FB_WITH_SYSTEM
    if (base[k % 2] == FB_BASE_FREE) {
      system_rests(speed);
    }
#endif
  }
}

/* E8.46: an asymmetric gyrostat spins steadily about an axis that is principal for nothing, w = (lambda 1 - J)^-1 h: found
   from a direction 5 degrees beside. From the direction of a principal axis, which is none with the wheels, as well. */
TEST(gyrostats_spin_steadily_about_no_axis_of_their_own)
{
  const double J[3] = {1.0, 2.0, 3.0}, lambda[3] = {4.0, 0.2, -1.0}, rotor[3] = {0.6, -0.5, 0.4}, I = 0.01;
  for (int base = FB_BASE_FREE; base < FB_BASE_COUNT; base++) {
    if (base != FB_BASE_FREE && base != FB_BASE_PINNED) {
      continue;
    }
    for (int run = 0; run < 4; run++) {
      double w[3], speed[3], size, L[3], across[3];
      fresh((fb_base)base, 0);
      for (int r = 0; r < 3; r++) {
        w[r] = run < 3 ? rotor[r] / (lambda[run] - J[r]) : r == 0 ? 0.7 : 0.0;
        speed[r] = rotor[r] / I;
        rotor_add(0, r == 0, r == 1, r == 2, I);
      }
      rigid_hub(50.0, 0.0, J[0], J[1], J[2]);
      spin_up(0, 0, 0, speed);
      size = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
      if (run < 3) { /* turned by 5 degrees about z */
        trim_at(cos(0.087) * w[0] - sin(0.087) * w[1], sin(0.087) * w[0] + cos(0.087) * w[1], w[2]);
        for (int i = 0; i < 3; i++) {
          FBT_NEAR_ABS(motion.w[i], w[i], FBT_TOL(1e-12, 1e-5));
        }
      } else {
        trim_at(w[0], w[1], w[2]);
      }
      for (int i = 0; i < 3; i++) {
        w[i] = (double)motion.w[i];
        L[i] = J[i] * w[i] + rotor[i];
        FBT_NEAR_ABS(motion.w_dot[i], 0.0, FBT_TOL(1e-12, 1e-5));
      }
      cross(across, w, L);
      FBT_NEAR_ABS(fabs(across[0]) + fabs(across[1]) + fabs(across[2]), 0.0, FBT_TOL(1e-12, 1e-5));
      FBT_NEAR_REL(sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]), size, FBT_TOL(1e-12, 1e-5));
    }
  }
}

/* E8.47: friction lets the speed decay at (d + slope)(1/I + 1/J), slope F s_0^2/(s^2 + s_0^2)^(3/2) of the tangent; the
   motor that balances it is what a refusal asks for, and another torque of it drives the speed with 1/I + 1/J. */
TEST(rotors_decay_by_the_tangent_of_their_friction)
{
  const double I = 0.02, J = 3.0, d = 2e-3, F = 4e-3, s0 = 0.5, both = 1.0 / I + 1.0 / J;
  for (int run = 0; run < 3; run++) {
    const double s = run == 0 ? 0.0 : run == 1 ? 0.4 : 30.0, root = sqrt(s * s + s0 * s0);
    const double decay = (d + F * s0 * s0 / (root * root * root)) * both;
    fb_rotor *rotor;
    fresh(FB_BASE_FREE, 0);
    rotor = rotor_add(0, 0, 1, 0, I);
    rotor->damping = (fb_real)d;
    rotor->friction = (fb_real)F;
    rotor->friction_speed = (fb_real)s0;
    rigid_hub(10.0, 0.0, 1.0, J, 2.5);
    spin_up(0, 0, 0, &s);
    if (run > 0) {
      FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_UNREST);
#if FB_WITH_DETAIL
      FBT_INT_EQ(fb_detail_last()->index, 0);
      FBT_NEAR_REL(fb_detail_last()->need, d * s + F * s / root, FBT_TOL(1e-13, 1e-5));
#endif
    }
    input.rotor[0].torque = (fb_real)(d * s + F * s / root);
    trim_at(0, 0, 0);
    memset(&ports, 0, sizeof ports);
    ports.n_in = ports.n_out = 1;
    ports.in[0].kind = FB_PORT_MOTOR;
    ports.out[0].kind = FB_PORT_ROTOR_SPEED;
    FBT_INT_EQ(fb_body_linearize(&body, &work, &linear, &state, &input, &ports), FB_OK);
    FBT_INT_EQ(linear.n, 13);
    FBT_INT_EQ(linear.n_free, 6);
    FBT_NEAR_REL(linear.B[0], 1.0, FBT_TOL(1e-10, 1e-3));
    FBT_NEAR_REL(linear.C[0], both, FBT_TOL(1e-10, 1e-3)); /* at constant momentum of all of it */
    FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, &spectrum, &state, &input), FB_OK);
    among(-decay, 0.0, FBT_TOL(1e-8, 1e-2) * decay);
  }
}

/* ---- flexible bodies */

/* x_j of the linear model increased by h, by its definition: momenta of the base in body axes at constant attitude. */
static fb_state moved_by(int j, double h)
{
  const int n = body.n, m = body.n_rotor - 1; /* the last but one is given */
  fb_state out = state;
  if (j < n) {
    out.q[j] += (fb_real)h;
  } else if (j < 2 * n) {
    out.pi[j - n] += (fb_real)h;
  } else if (j < 2 * n + m) {
    out.pi[n + (j == 2 * n ? 0 : 2)] += (fb_real)h;
  } else {
    const int i = j - 2 * n - m + (body.base == FB_BASE_FREE ? 0 : body.base == FB_BASE_PINNED ? 3 : 5);
    fb_real R[9];
    fb_quat_to_mat33(R, state.quat);
    for (int k = 0; k < 3; k++) {
      if (i < 3) {
        out.u[k] += (fb_real)(h / (double)body.mass) * R[3 * k + i];
      } else {
        out.L[k] += (fb_real)h * R[3 * k + i - 3];
      }
    }
  }
  return out;
}

/* Rates of q, pi, rotors and the angular momentum in body axes; speeds of the rotors. */
static int rates_at(double *f, const fb_state *at, const fb_input *in)
{
  const int n = body.n;
  fb_state rate;
  fb_motion now;
  fb_real R[9], L[3], L_dot[3], turn[3];
  FBT_INT_EQ(fb_body_rates_eval(&body, &rate, at, in), FB_OK);
  FBT_INT_EQ(fb_body_motion_eval(&body, &now, at, in), FB_OK);
  for (int a = 0; a < n; a++) {
    f[a] = (double)rate.q[a];
    f[n + a] = (double)rate.pi[a];
  }
  f[2 * n] = (double)rate.pi[n];
  f[2 * n + 1] = (double)rate.pi[n + 2];
  fb_quat_to_mat33(R, at->quat);
  fb_mat33_mulT_vec3(L, R, at->L);
  fb_mat33_mulT_vec3(L_dot, R, rate.L);
  fb_vec3_cross(turn, now.w, L);
  for (int i = 0; i < 3; i++) {
    f[2 * n + 2 + i] = (double)(L_dot[i] - turn[i]);
    f[2 * n + 5 + i] = (double)now.rotor_speed[i];
  }
  return 2 * n + 8;
}

/* E12.2, E8.47: A, B and C are derivatives of rates and speeds by states and motors, on all bases, about a state that
   bends, turns and has wheels that turn at all speeds: the middle wheel's momentum is given. */
TEST(linear_models_of_rotors_are_derivatives_of_rates)
{
  for (int set = 0; set < FBT_COUNT(sets); set++) {
    for (int base = 0; base < FB_BASE_COUNT; base++) {
      const int first = base == FB_BASE_FREE ? 0 : base == FB_BASE_PINNED ? 3 : base == FB_BASE_HINGED ? 5 : 6;
      const fb_real still[3] = {0, 0, 0}, own = base == FB_BASE_HINGED ? FB_R(0.0) : FB_R(0.1);
      const fb_real w[3] = {own, -FB_R(2.0) * own, FB_R(0.3)};
      double largest = 0.0, worst = 0.0;
      int rows, count;
      if (sets[set] == FB_EFFECTS_LARGE && !FB_WITH_LARGE_DEFLECTION) {
        continue;
      }
      fbt_seed(15);
      craft(sets[set], (fb_base)base, 1);
      desc.rotor[1].given = 1;
      FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
      input.rotor[1].momentum = -FB_R(0.3);
      input.rotor[0].torque = FB_R(0.01);
      FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
      for (int a = 0; a < body.n; a++) {
        state.q[a] = FB_R(0.02) * (fb_real)fbt_random();
      }
      state.pi[body.n + 1] = input.rotor[1].momentum;
      memcpy(input.w, base == FB_BASE_PRESCRIBED ? w : still, sizeof w);
      FBT_INT_EQ(fb_state_from_velocity(&body, &state, still, w, NULL), FB_OK);
      FBT_INT_EQ(fb_state_rotor_set(&body, &state, 0, FB_R(1.5), 0, &input), FB_OK);
      FBT_INT_EQ(fb_state_rotor_set(&body, &state, 2, FB_R(45.0), 0, &input), FB_OK);
      state.pi[body.n + 1] = FB_R(0.7); /* of no meaning: the input gives it */
      memset(&ports, 0, sizeof ports);
      ports.n_in = ports.n_out = 3;
      for (int r = 0; r < 3; r++) {
        ports.in[r].kind = FB_PORT_MOTOR;
        ports.out[r].kind = FB_PORT_ROTOR_SPEED;
        ports.in[r].axis = ports.out[r].axis = r;
      }
      FBT_INT_EQ(fb_body_linearize(&body, &work, &linear, &state, &input, &ports), FB_OK);
      FBT_INT_EQ(linear.n, 2 * body.n + 2 + 2 * (6 - first));
      FBT_BELOW(linear.error, FBT_TOL(1e-8, 1e-2));
      count = 2 * body.n + 2 + 6 - first;
      for (int j = 0; j < count + 3; j++) {
        double f[2][2 * FB_MAX_MODES + 8], scale = j < body.n ? 1e-5 : 1e-4;
        scale *= FBT_TOL(1.0, 300.0);
        for (int side = 0; side < 2; side++) {
          const double h = side ? scale : -scale;
          fb_input in = input;
          fb_state at = state;
          if (j < count) {
            at = moved_by(j, h);
          } else if (j == count + 1) {
            in.rotor[1].momentum += (fb_real)h;
          } else {
            in.rotor[j - count].torque += (fb_real)h;
          }
          rows = rates_at(f[side], &at, &in);
        }
        for (int i = 0; i < rows; i++) {
          const int speed = i - (rows - 3), turn = i - (rows - 6), momentum = 2 * body.n + 2 + turn - (first - 3);
          const double want = (f[1][i] - f[0][i]) / (2.0 * scale);
          const fb_real *const A = j < count ? linear.A + j : linear.B + j - count;
          const int width = j < count ? linear.n : 3;
          if (speed < 0 && turn >= 0 && turn + 3 < first) {
            continue; /* held */
          }
          largest = fmax(largest, fabs(want));
          worst = fmax(worst, fabs(want - (double)(speed >= 0 ? (j < count ? linear.C + speed * linear.n + j
                                                                           : linear.D + speed * 3 + j - count)[0]
                                                              : A[(turn >= 0 ? momentum : i) * width])));
        }
      }
      FBT_ZERO(worst, largest, FBT_TOL(1e-6, 5e-2));
    }
  }
}

/* E8.46: a bent craft in the steady spin that trim finds, with wheels on sections that the modes move, stays in it. */
TEST(flexible_gyrostats_stay_in_their_steady_spin)
{
  for (int set = 2; set < FBT_COUNT(sets); set++) {
    fb_state first;
    fb_real w[3];
    if (sets[set] == FB_EFFECTS_LARGE && !FB_WITH_LARGE_DEFLECTION) {
      continue;
    }
    craft(sets[set], FB_BASE_FREE, 0);
    desc.rotor[2].given = 1;
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
    input.rotor[2].momentum = FB_R(0.4);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_state_rotor_set(&body, &state, 0, FB_R(30.0), 0, &input), FB_OK);
    FBT_INT_EQ(fb_state_rotor_set(&body, &state, 1, -FB_R(60.0), 0, &input), FB_OK);
    trim_at(0.1, 0.05, 0.3);
    FBT_NEAR_REL(sqrt((double)fb_vec3_dot(motion.w, motion.w)), sqrt(0.1025), FBT_TOL(1e-10, 1e-4));
    FBT_TRUE(fbt_largest(state.q, body.n) > 1e-4);
    first = state;
    memcpy(w, motion.w, sizeof w);
    for (int k = 0; k < 400; k++) {
      FBT_INT_EQ(fb_rk4_step(&body, &state, &rk4, &input, &input, &input, FB_R(0.005)), FB_OK);
    }
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &input), FB_OK);
    FBT_NEAR_ABS(fbt_difference(first.q, state.q, body.n), 0.0, FBT_TOL(1e-8, 1e-3));
    FBT_NEAR_ABS(fbt_difference(motion.w, w, 3), 0.0, FBT_TOL(1e-8, 1e-3));
  }
}

/* ---- refusals */

/* Interface: ports of rotors that are not there; what has no linear model. */
TEST(analysis_of_rotors_refuses_bad_input)
{
  const double speed = 3.0;
  fb_state kept;
  fresh(FB_BASE_FREE, 0);
  rotor_add(0, 0, 0, 1, 0.1)->static_imbalance = FB_R(1e-4);
  rotor_add(0, 1, 0, 0, 0.1)->given = 1;
  rigid_hub(10.0, 0.0, 1.0, 1.0, 1.0);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);

  /* an imbalance that turns, a given momentum that changes */
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_OK);
  FBT_INT_EQ(fb_state_rotor_set(&body, &state, 0, (fb_real)speed, 0, &input), FB_OK);
  kept = state;
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_UNREST);
  FBT_INT_EQ(fb_body_linearize(&body, &work, &linear, &state, &input, NULL), FB_ERR_UNREST);
  FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, &spectrum, &state, &input), FB_ERR_UNREST);
  body.rotor[0].static_imbalance = 0;
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_OK);
  kept = state;
  input.rotor[1].torque = FB_R(0.1);
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_UNREST);
  FBT_TRUE(memcmp(&kept, &state, sizeof state) == 0);
  input.rotor[1].torque = 0;

  /* ports */
  for (int k = 0; k < 6; k++) {
    static const fb_status expected[6] = {FB_OK,           FB_ERR_CAPACITY, FB_ERR_CAPACITY,
                                          FB_ERR_CAPACITY, FB_ERR_VALUE,    FB_ERR_VALUE};
    memset(&ports, 0, sizeof ports);
    ports.n_in = k != 5;
    ports.n_out = k == 5;
    ports.in[0].kind = k == 4 ? FB_PORT_ROTOR_SPEED : FB_PORT_MOTOR;
    ports.out[0].kind = FB_PORT_MOTOR;
    ports.in[0].axis = k == 1 ? 2 : k == 2 ? -1 : 1;
    ports.in[0].body = k == 3;
    FBT_INT_EQ(fb_body_linearize(&body, &work, &linear, &state, &input, &ports), expected[k]);
  }
}

SUITE(analyse_rotors, RUN(momentum_wheels_give_their_platform_a_nutation),
      RUN(wheels_at_any_speeds_leave_a_craft_at_rest), RUN(gyrostats_spin_steadily_about_no_axis_of_their_own),
      RUN(rotors_decay_by_the_tangent_of_their_friction), RUN(linear_models_of_rotors_are_derivatives_of_rates),
      RUN(flexible_gyrostats_stay_in_their_steady_spin), RUN(analysis_of_rotors_refuses_bad_input))
#endif
