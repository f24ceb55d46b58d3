/* >>body: rotors: wheels inside a body. Closed forms of gyrostats, wheels as bodies on hinges, conservation, and the
   definition of their momentum by the motion of the node they sit on. */
#include "rotors.h"
#if FB_WITH_ROTORS

static fb_state before;
static fb_rk4_work rk4;
static fb_implicit_work implicit;
static fb_exponential exponential;
static fb_exponential_work exponential_work;

static fb_status step(int integrator, double dt)
{
  switch (integrator) {
  case FB_INTEGRATOR_MIDPOINT:
    return fb_midpoint_step(&body, &state, &implicit, &input, (fb_real)dt, 4);
  case FB_INTEGRATOR_SDIRK:
    return fb_sdirk_step(&body, &state, &implicit, &input, &input, (fb_real)dt, 4);
  case FB_INTEGRATOR_EXPONENTIAL:
    return fb_exponential_step(&body, &exponential, &state, &exponential_work, &input, &input, &input);
  default:
    return fb_rk4_step(&body, &state, &rk4, &input, &input, &input, (fb_real)dt);
  }
}

static void run(int integrator, double dt, int steps)
{
  fb_status status = FB_OK;
  if (integrator == FB_INTEGRATOR_EXPONENTIAL) {
    FBT_INT_EQ(fb_exponential_init(&exponential, &body_work, &body, (fb_real)dt), FB_OK);
  }
  for (int k = 0; k < steps && status == FB_OK; k++) {
    status = step(integrator, dt);
  }
  FBT_INT_EQ(status, FB_OK);
}

static void look(void)
{
  FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &input), FB_OK);
}

/* ---- closed forms */

/* E8.41, E8.13: A, A, C about O and a wheel of momentum h along z: the angular velocity turns in the body at lambda =
   ((C - A) w_z + h)/A (nutation), the body about its constant angular momentum L at |L|/A (wobble): R(t) = exp(L t/A)
   exp(e_z (w_z - L_z/A) t), L_z = C w_z + h. */
TEST(gyrostats_nutate_and_wobble_in_closed_form)
{
  const double A = 1.5, C = 1.04, I = 0.04, w_x = 0.02, w_z = 0.1, speed = 120.0, T = 4.0;
  const double h = I * (w_z + speed), lambda = ((C - A) * w_z + h) / A;
  for (int integrator = 0; integrator < 2; integrator++) { /* rk4, and the midpoint rule with steps of a tenth */
    const double dt = integrator == 0 ? FBT_TOL(0.005, 0.01) : FBT_TOL(0.00005, 0.002);
    const double bound = integrator == 0 ? FBT_TOL(1e-8, 1e-5) : FBT_TOL(1e-8, 1e-4);
    fb_real L[3], turn[4], about[4], quat[4];
    const fb_real own[3] = {0, 0, (fb_real)((w_z - (C * w_z + h) / A) * T)};
    fresh(FB_BASE_FREE, 0);
    rotor_add(0, 0, 0, 2, I);
    rigid_hub(400.0, 0.0, A, A, C);
    spin_up(w_x, 0, w_z, &speed);
    FBT_NEAR_REL(state.pi[0], h, FBT_TOL(1e-14, 1e-6));
    FBT_NEAR_REL(state.L[2], C * w_z + h, FBT_TOL(1e-14, 1e-6));
    for (int i = 0; i < 3; i++) {
      L[i] = (fb_real)((double)state.L[i] * T / A);
    }
    run(integrator == 0 ? FB_INTEGRATOR_RK4 : FB_INTEGRATOR_MIDPOINT, dt, (int)(T / dt + 0.5));
    look();
    FBT_NEAR_ABS(motion.w[0], w_x * cos(lambda * T), bound);
    FBT_NEAR_ABS(motion.w[1], w_x * sin(lambda * T), bound);
    FBT_NEAR_ABS(motion.w[2], w_z, bound);
    FBT_NEAR_REL(motion.rotor_speed[0], speed, FBT_TOL(1e-10, 1e-5));
    fb_quat_from_rotvec(turn, L);
    fb_quat_from_rotvec(about, own);
    fb_quat_mul(quat, turn, about);
    for (int i = 0; i < 4; i++) {
      const double sign = (double)(quat[0] * state.quat[0]) > 0.0 ? 1.0 : -1.0;
      FBT_NEAR_ABS(state.quat[i], sign * (double)quat[i], FBT_TOL(1.0, 10.0) * bound);
    }
  }
}

/* E8.41, E8.16: a gyrostat whose own body does not spin, pinned off its mass center under gravity g: at inclination
   theta it precesses at Omega about the vertical where h Omega + (C - A) Omega^2 cos(theta) = m g l. */
TEST(gyroscopes_precess_in_closed_form)
{
  const double A = 2.0, C = 0.7, m = 4.0, l = 0.3, g = 9.81, theta = 1.1, Omega = 0.8, T = 2.0, I = 0.05;
  const double h = (m * g * l - (C - A) * Omega * Omega * cos(theta)) / Omega;
  const double speed = h / I - Omega * cos(theta);
  const fb_real tilt[3] = {0, (fb_real)theta, 0}, about[3] = {0, 0, (fb_real)(Omega * T)};
  const fb_real still[3] = {0, 0, 0};
  const fb_real w[3] = {(fb_real)(-Omega * sin(theta)), 0, (fb_real)(Omega * cos(theta))};
  fb_real start[4], turn[4], quat[4];
  fresh(FB_BASE_PINNED, FB_EFFECT_GRAVITY);
  desc.gravity[2] = (fb_real)-g;
  rotor_add(0, 0, 0, 1, I);
  rigid_hub(m, l, A, A, C);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  fb_quat_from_rotvec(start, tilt);
  memcpy(state.quat, start, sizeof start);
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, still, w, NULL), FB_OK);
  FBT_INT_EQ(fb_state_rotor_set(&body, &state, 0, (fb_real)speed, 0, NULL), FB_OK);
  run(FB_INTEGRATOR_RK4, FBT_TOL(0.002, 0.004), FBT_TOL(1000, 500));
  look();
  fb_quat_from_rotvec(turn, about);
  fb_quat_mul(quat, turn, start);
  for (int i = 0; i < 4; i++) {
    FBT_NEAR_ABS(state.quat[i], quat[i], FBT_TOL(1e-8, 1e-4));
  }
  for (int i = 0; i < 3; i++) {
    FBT_NEAR_ABS(motion.w[i], w[i], FBT_TOL(1e-8, 1e-4));
  }
}

/* E8.41: an asymmetric gyrostat spins steadily about an axis that is principal for nothing: h is parallel to w where w
   = (lambda 1 - J)^-1 sum h_r a_r, stable for lambda above the largest moment of inertia. */
TEST(asymmetric_gyrostats_spin_steadily)
{
  const double J[3] = {1.0, 2.0, 3.0}, lambda = 4.0, rotor[3] = {0.6, -0.5, 0.4}, I = 0.01;
  double w[3], speed[3];
  fresh(FB_BASE_FREE, 0);
  for (int r = 0; r < 3; r++) {
    w[r] = rotor[r] / (lambda - J[r]);
    speed[r] = rotor[r] / I - w[r];
    rotor_add(0, r == 0, r == 1, r == 2, I);
  }
  rigid_hub(50.0, 0.0, J[0], J[1], J[2]);
  spin_up(w[0], w[1], w[2], speed);
  run(FB_INTEGRATOR_RK4, 0.01, 2000);
  look();
  for (int i = 0; i < 3; i++) {
    FBT_NEAR_ABS(motion.w[i], w[i], FBT_TOL(1e-11, 1e-5));
    FBT_NEAR_ABS(motion.w_dot[i], 0.0, FBT_TOL(1e-11, 1e-5));
  }
}

/* E8.43, E8.44: a motor turns the wheel one way and the body the other; viscous friction lets the relative speed decay
   at d (1/I + 1/J), dry friction far above its speed brakes evenly. The angle is the integral, within half a turn. */
TEST(motors_and_friction_act_between_wheel_and_body)
{
  const double I = 0.02, J = 3.0, T = 5.0, motor = 0.01, d = 2e-3, dry = 4e-3, slow = 1e-4;
  const double both = 1.0 / I + 1.0 / J, none = 0.0, fast = 40.0;
  double angle;

  /* motor */
  fresh(FB_BASE_FREE, 0);
  rotor_add(0, 0, 1, 0, I);
  rigid_hub(10.0, 0.0, 1.0, J, 2.5);
  spin_up(0, 0, 0, &none);
  input.rotor[0].torque = (fb_real)motor;
  run(FB_INTEGRATOR_RK4, 0.01, 500);
  look();
  angle = 0.5 * motor * both * T * T;
  FBT_NEAR_REL(motion.w[1], -motor * T / J, FBT_TOL(1e-10, 1e-5));
  FBT_NEAR_REL(motion.rotor_speed[0], motor * T * both, FBT_TOL(1e-10, 1e-5));
  FBT_NEAR_ABS(state.q[0], angle - 2.0 * 3.14159265358979323846, FBT_TOL(1e-9, 1e-4));
  FBT_NEAR_ABS(fbt_largest(state.L, 3), 0.0, FBT_TOL(1e-15, 1e-7));
  FBT_NEAR_REL(motion.w_dot[1], -motor / J, FBT_TOL(1e-10, 1e-5));

  /* viscous friction, and a body that turns by itself */
  fresh(FB_BASE_FREE, 0);
  rotor_add(0, 0, 1, 0, I)->damping = (fb_real)d;
  rigid_hub(10.0, 0.0, 1.0, J, 2.5);
  spin_up(0, 0.3, 0, &fast);
  run(FB_INTEGRATOR_RK4, 0.01, 500);
  look();
  FBT_NEAR_REL(motion.rotor_speed[0], fast * exp(-d * both * T), FBT_TOL(1e-9, 1e-5));
  FBT_NEAR_REL(J * (double)motion.w[1] + I * ((double)motion.w[1] + (double)motion.rotor_speed[0]),
               J * 0.3 + I * (0.3 + fast), FBT_TOL(1e-12, 1e-5));

  /* dry friction, either way */
  for (int sign = -1; sign <= 1; sign += 2) {
    const double speed = sign * fast;
    fb_rotor *rotor;
    fresh(FB_BASE_FREE, 0);
    rotor = rotor_add(0, 0, 1, 0, I);
    rotor->friction = (fb_real)dry;
    rotor->friction_speed = (fb_real)slow;
    rigid_hub(10.0, 0.0, 1.0, J, 2.5);
    spin_up(0, 0, 0, &speed);
    run(FB_INTEGRATOR_RK4, FBT_TOL(1e-4, 4e-4), FBT_TOL(50000, 12500));
    look();
    FBT_NEAR_REL(motion.rotor_speed[0], sign * (fast - dry * both * T), FBT_TOL(1e-9, 1e-4));
  }
}

/* ---- flexible bodies */

/* E8.41: what rotors add to a body of the same velocities: momentum I (a.w + speed) along the axis, a and w those of the
   section they sit on; energy h^2/(2 I). The momenta of the modes give back the velocities. */
TEST(momenta_of_rotors_are_those_of_their_sections)
{
  static fb_body plain;
  for (int set = 0; set < FBT_COUNT(sets); set++) {
    for (int base = 0; base < FB_BASE_COUNT; base++) {
      fb_momentum with, without;
      fb_energy sum, rest;
      fb_state bare;
      double L[3] = {0}, T = 0.0;
      if (sets[set] == FB_EFFECTS_LARGE && !FB_WITH_LARGE_DEFLECTION) {
        continue;
      }
      fbt_seed(11);
      craft(sets[set], (fb_base)base, 0);
      craft_moves(0.05);
      desc.n_rotor = 0;
      memset(desc.rotor, 0, sizeof desc.rotor);
      FBT_INT_EQ(fb_body_init(&plain, &body_work, &shape, &desc), FB_OK);
      look();
      if (base == FB_BASE_PRESCRIBED) { /* as after a step: u is the velocity of the base */
        const fb_real v[3] = {FB_R(0.2), -FB_R(0.1), FB_R(0.3)}, w[3] = {FB_R(0.3), FB_R(0.2), -FB_R(0.4)};
        memcpy(input.v, v, sizeof v);
        memcpy(input.w, w, sizeof w);
        FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, w, motion.q_dot), FB_OK);
        look();
      }
      bare = state;
      FBT_INT_EQ(fb_state_from_velocity(&plain, &bare, motion.v, motion.w, motion.q_dot), FB_OK);
      FBT_INT_EQ(fb_body_momentum_eval(&body, &with, &state, &input), FB_OK);
      FBT_INT_EQ(fb_body_momentum_eval(&plain, &without, &bare, &input), FB_OK);
      FBT_INT_EQ(fb_body_energy_eval(&body, &sum, &state, &input), FB_OK);
      FBT_INT_EQ(fb_body_energy_eval(&plain, &rest, &bare, &input), FB_OK);
      for (int r = 0; r < body.n_rotor; r++) {
        const fb_rotor *const rotor = &body.rotor[r];
        const double I = (double)rotor->inertia;
        fb_node_motion at;
        fb_real R[9], axis[3];
        double h;
        FBT_INT_EQ(fb_body_node_motion_eval(&body, &at, &state, &motion, rotor->node), FB_OK);
        fb_quat_to_mat33(R, at.quat);
        fb_mat33_mul_vec3(axis, R, rotor->axis);
        h = I * ((double)fb_vec3_dot(axis, at.angular_rate) + (double)motion.rotor_speed[r]);
        FBT_NEAR_ABS(motion.rotor_momentum[r], h, FBT_TOL(1e-13, 1e-5));
        FBT_NEAR_ABS(state.pi[body.n + r], h, FBT_TOL(1e-13, 1e-5));
        T += 0.5 * h * h / I;
        for (int i = 0; i < 3; i++) {
          L[i] += h * (double)axis[i];
        }
      }
      FBT_NEAR_ABS(sum.kinetic - rest.kinetic, T, FBT_TOL(1e-10, 1e-3));
      FBT_NEAR_ABS(fbt_difference(with.linear, without.linear, 3), 0.0, FBT_TOL(1e-12, 1e-4));
      for (int i = 0; i < 3; i++) {
        if (base != FB_BASE_HINGED) {
          FBT_NEAR_ABS(with.angular[i] - without.angular[i], L[i], FBT_TOL(1e-11, 1e-4));
        }
      }
    }
  }
}

static double energy_now(void)
{
  fb_energy e;
  FBT_INT_EQ(fb_body_energy_eval(&body, &e, &state, &input), FB_OK);
  return (double)e.kinetic + (double)e.strain + (double)e.gravity;
}

/* E8.43: without motors and friction energy and both momenta are constant, whatever the effects: the error falls with the
   fifth power of the step. */
TEST(gyrostats_keep_energy_and_momentum)
{
  for (int set = 0; set < FBT_COUNT(sets); set++) {
    double drift[2];
    if (sets[set] == FB_EFFECTS_LARGE && !FB_WITH_LARGE_DEFLECTION) {
      continue;
    }
    for (int half = 0; half < 2; half++) {
      fb_momentum first, last;
      double energy;
      fbt_seed(12);
      craft(sets[set], FB_BASE_FREE, 0);
      craft_moves(0.03);
      FBT_INT_EQ(fb_body_momentum_eval(&body, &first, &state, NULL), FB_OK);
      energy = energy_now();
      run(FB_INTEGRATOR_RK4, FBT_TOL(1e-3, 1e-3) / (1 << half), 400 << half);
      drift[half] = fabs(energy_now() / energy - 1.0);
      FBT_INT_EQ(fb_body_momentum_eval(&body, &last, &state, NULL), FB_OK);
      FBT_NEAR_ABS(fbt_difference(first.angular, last.angular, 3), 0.0, FBT_TOL(1e-12, 1e-4));
      FBT_NEAR_ABS(fbt_difference(first.linear, last.linear, 3), 0.0, FBT_TOL(1e-12, 1e-4));
    }
    FBT_BELOW(drift[1], FBT_TOL(1e-8, 1e-4));
    if (!FB_SINGLE) {
      FBT_BELOW(drift[1], drift[0] / 20.0);
    }
  }
}

/* E8.43: the energy changes by what motors, friction and loads do. */
TEST(power_of_rotors_is_the_rate_of_energy)
{
  for (int base = 0; base < FB_BASE_COUNT; base++) {
    for (int set = 0; set < FBT_COUNT(sets); set++) {
      fb_state rate;
      double power;
      if ((sets[set] == FB_EFFECTS_LARGE && !FB_WITH_LARGE_DEFLECTION) || base == FB_BASE_PRESCRIBED) {
        continue;
      }
      fbt_seed(13);
      craft(sets[set], (fb_base)base, 1);
      craft_moves(0.03);
      input.n_load = 1;
      input.load[0].node = 1;
      input.load[0].force[1] = FB_R(0.7);
      input.load[0].torque[2] = FB_R(0.3);
      power = power_of(&state, &input);
      look();
      for (int r = 0; r < 3; r++) {
        const double s = (double)motion.rotor_speed[r];
        input.rotor[r].torque = (fb_real)(0.05 * (r + 1));
        power += s * (0.05 * (r + 1) - 1e-4 * s - 2e-3 * s / sqrt(s * s + 4.0));
      }
      FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, &input), FB_OK);
      {
        const double h = FBT_TOL(1e-5, 1e-3);
        double e[2];
        for (int side = 0; side < 2; side++) {
          fb_state at;
          fb_energy energy;
          state_along(&at, &state, &rate, side ? h : -h);
          for (int a = body.n; a < body.n_coordinate; a++) {
            at.pi[a] += (fb_real)(side ? h : -h) * rate.pi[a];
          }
          FBT_INT_EQ(fb_body_energy_eval(&body, &energy, &at, NULL), FB_OK);
          e[side] = (double)energy.kinetic + (double)energy.strain;
        }
        FBT_NEAR_ABS((e[1] - e[0]) / (2.0 * h), power, FBT_TOL(1e-6, 3e-2));
      }
    }
  }
}

/* A craft with n wheels: its accelerations against differences of its velocities along the motion, the reactions of its
   base against those of its momenta. */
static void accelerations_follow_velocities(int n, int set, fb_base base)
{
  const double h = 1e-5;
  fb_motion at[2];
  fb_momentum momentum[2];
  fb_real torque[3], force[3], R[9], arm[3];
  fbt_seed(14);
  craft_of(n, sets[set], base, 1);
  craft_moves(0.03);
  for (int r = 0; r < n; r++) {
    input.rotor[r].torque = (fb_real)(0.05 * (r + 1));
  }
  if (base == FB_BASE_PRESCRIBED) {
    const fb_real v[3] = {FB_R(0.2), -FB_R(0.1), FB_R(0.3)}, w[3] = {FB_R(0.3), FB_R(0.2), -FB_R(0.4)};
    memcpy(input.v, v, sizeof v);
    memcpy(input.w, w, sizeof w);
    FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, w, NULL), FB_OK);
  }
  look();
  before = state;
  for (int side = 0; side < 2; side++) {
    fb_state rate;
    state = before;
    FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, &input), FB_OK);
    state_along(&state, &before, &rate, side ? h : -h);
    for (int a = body.n; a < body.n_coordinate; a++) {
      state.pi[a] += (fb_real)(side ? h : -h) * rate.pi[a];
    }
    FBT_INT_EQ(fb_body_motion_eval(&body, &at[side], &state, &input), FB_OK);
    FBT_INT_EQ(fb_body_momentum_eval(&body, &momentum[side], &state, &input), FB_OK);
  }
  for (int i = 0; i < 3; i++) {
    FBT_NEAR_ABS((double)(at[1].w[i] - at[0].w[i]) / (2 * h), motion.w_dot[i], 2e-6);
    force[i] = (fb_real)((double)(momentum[1].linear[i] - momentum[0].linear[i]) / (2 * h));
    torque[i] = (fb_real)((double)(momentum[1].angular[i] - momentum[0].angular[i]) / (2 * h));
  }
  for (int a = 0; a < body.n; a++) {
    FBT_NEAR_ABS((double)(at[1].q_dot[a] - at[0].q_dot[a]) / (2 * h), motion.q_ddot[a], 1e-4);
  }
  fb_quat_to_mat33(R, before.quat);
  fb_vec3_cross(arm, before.rho, force);
  for (int i = 0; i < 3; i++) {
    torque[i] -= arm[i];
  }
  fb_mat33_mulT_vec3(arm, R, torque);
  for (int i = 0; i < 3; i++) {
    const int held = base == FB_BASE_PRESCRIBED || (base == FB_BASE_HINGED && i < 2);
    if (base != FB_BASE_FREE && (set >= 2 || base != FB_BASE_PRESCRIBED)) { /* less effects: nearly */
      FBT_NEAR_ABS(arm[i], held ? motion.reaction_torque[i] : FB_R(0.0), 1e-5);
    }
  }
}

/* E8.44: accelerations are derivatives of velocities along the motion, with motors and friction; reactions of a
   prescribed base are the rate of the body's momenta. Wheels on the hub alone, then on the boom, too. */
TEST(accelerations_of_gyrostats_are_derivatives_of_velocities)
{
  for (int set = 0; set < FBT_COUNT(sets) && !FB_SINGLE; set++) {
    for (int base = 0; base < FB_BASE_COUNT; base++) {
      if (sets[set] != FB_EFFECTS_LARGE || FB_WITH_LARGE_DEFLECTION) {
        accelerations_follow_velocities(1, set, (fb_base)base);
        accelerations_follow_velocities(3, set, (fb_base)base);
      }
    }
  }
}

/* E11.7, E11.8, E11.10: all integrators converge to the same motion, each with its order. */
TEST(integrators_of_gyrostats_agree)
{
  static const double order[FB_INTEGRATOR_COUNT] = {4.0, 2.0, 2.0, 4.0};
  static fb_state exact;
  const double T = 0.064;
  for (int set = 2; set < FBT_COUNT(sets) && !FB_SINGLE; set++) {
    if (sets[set] == FB_EFFECTS_LARGE && !FB_WITH_LARGE_DEFLECTION) {
      continue;
    }
    for (int integrator = -1; integrator < FB_INTEGRATOR_COUNT; integrator++) {
      double error[2] = {0.0, 0.0};
      for (int half = 0; half < 2; half++) {
        const int steps = integrator < 0 ? 512 : 64 << half;
        fbt_seed(15);
        craft(sets[set], FB_BASE_FREE, 1);
        craft_moves(0.005);
        for (int r = 0; r < 3; r++) {
          input.rotor[r].torque = (fb_real)(0.2 * (r - 1));
        }
        run(integrator < 0 ? FB_INTEGRATOR_RK4 : integrator, T / steps, steps);
        if (integrator < 0) {
          exact = state;
          break;
        }
        error[half] = fmax(fbt_difference(state.q, exact.q, body.n), fbt_difference(state.quat, exact.quat, 4));
        error[half] = fmax(error[half], fbt_difference(state.pi + body.n, exact.pi + body.n, 3));
        error[half] = fmax(error[half], fbt_difference(state.q + body.n, exact.q + body.n, 3));
      }
      if (integrator >= 0) {
        FBT_BELOW(error[1], order[integrator] > 3.0 ? 1e-8 : 1e-5);
        FBT_NEAR_ABS(log2(error[0] / error[1]), order[integrator], 0.5);
      }
    }
  }
}

/* ---- steps */

/* E11.46: a wheel at 600 rad/s costs no step: 10 ms give the attitude of 1 ms to 1e-8 rad. */
TEST(wheels_at_600_rad_per_s_cost_no_step)
{
  const double speed[3] = {600.0, -600.0, 300.0};
  fb_real quat[2][4];
  for (int k = 0; k < 2; k++) {
    fresh(FB_BASE_FREE, 0);
    for (int r = 0; r < 3; r++) {
      rotor_add(0, r == 0, r == 1, r == 2, 0.04);
    }
    rigid_hub(400.0, 0.0, 150.0, 120.0, 100.0);
    spin_up(0.05, 0.02, -0.03, speed);
    input.rotor[1].torque = FB_R(0.1);
    run(FB_INTEGRATOR_RK4, k == 0 ? 1e-3 : 1e-2, k == 0 ? 10000 : 1000);
    memcpy(quat[k], state.quat, sizeof quat[k]);
  }
  FBT_NEAR_ABS(fbt_difference(quat[0], quat[1], 4), 0.0, FBT_TOL(5e-9, 1e-4));
}

/* E11.46, E8.45: the limit of rk4 by nutation, spin + h mobility/2 twice: 5 % beyond it is refused, below it the energy
   holds; friction and imbalance count, too. */
TEST(rotors_bound_the_step)
{
  const double A = 1.5, C = 1.0, I = 0.04, w_x = 1e-3;
  fb_body_limit longest;
  for (int k = 0; k < 3; k++) {
    const double speed = 400.0 * pow(10.0, k), h = I * speed, limit = 2.785 / (h / A + 2.0 * w_x);
    double energy;
    fresh(FB_BASE_FREE, 0);
    rotor_add(0, 0, 0, 1, I);
    rigid_hub(400.0, 0.0, A, A, C);
    FBT_NEAR_REL(body.rotor[0].mobility, 1.0 / A, FBT_TOL(1e-12, 1e-5));
    FBT_NEAR_REL(body.rotor[0].rate, 0.0, 0.0);
    spin_up(w_x, 0, 0, &speed);
    before = state;
    FBT_INT_EQ(fb_body_limit_eval(&body, &longest, &state, &input), FB_OK);
    FBT_NEAR_REL(longest.rk4, limit, FBT_TOL(1e-12, 1e-5));
    FBT_NEAR_REL(longest.spin, h / A / 2.0 + w_x, FBT_TOL(1e-12, 1e-5));
    FBT_NEAR_REL(longest.implicit, 0.1 / (h / A / 2.0 + w_x), FBT_TOL(1e-12, 1e-5));
    FBT_INT_EQ(step(FB_INTEGRATOR_RK4, 1.02 * limit), FB_ERR_STEP);
    FBT_INT_EQ(step(FB_INTEGRATOR_MIDPOINT, 0.11 / (h / A / 2.0 + w_x)), FB_ERR_STEP);
    FBT_INT_EQ(step(FB_INTEGRATOR_SDIRK, 0.11 / (h / A / 2.0 + w_x)), FB_ERR_STEP);
    FBT_TRUE(memcmp(&before, &state, sizeof state) == 0);
    energy = energy_now();
    run(FB_INTEGRATOR_RK4, 0.98 * limit, 500);
    FBT_NEAR_REL(energy_now(), energy, FBT_TOL(1e-9, 1e-4));
  }
  for (int k = 0; k < 2; k++) {
    const double speed = 50.0;
    fb_rotor *rotor;
    fresh(FB_BASE_FREE, 0);
    rotor = rotor_add(0, 0, 0, 1, I);
    if (k == 0) {
      rotor->friction = FB_R(0.1);
      rotor->friction_speed = FB_R(0.01);
      rotor->damping = FB_R(0.2);
    } else {
      rotor->static_imbalance = FB_R(1e-4);
    }
    rigid_hub(400.0, 0.0, 1e3, 1e3, C);
    spin_up(0, 0, 0, &speed);
    if (k == 0) {
      FBT_NEAR_REL(body.rotor[0].rate, 10.2 * (1.0 / I + 1.0 / C), FBT_TOL(1e-12, 1e-5));
      FBT_INT_EQ(step(FB_INTEGRATOR_RK4, 1.4 / (10.2 * (1.0 / I + 1.0 / C))), FB_ERR_STEP);
      FBT_INT_EQ(step(FB_INTEGRATOR_RK4, 1.35 / (10.2 * (1.0 / I + 1.0 / C))), FB_OK);
    } else {
      FBT_INT_EQ(step(FB_INTEGRATOR_RK4, 1.4 / speed), FB_ERR_STEP);
      FBT_INT_EQ(step(FB_INTEGRATOR_RK4, 1.35 / speed), FB_OK);
    }
  }
}

/* E8.8, E11.6, E11.46: a step of one body is refused just beyond what its limit says, and taken just below. */
TEST(steps_of_one_body_are_those_of_its_limit)
{
  for (int set = 0; set < FBT_COUNT(sets); set++) {
    for (int base = 0; base < FB_BASE_COUNT; base++) {
      fb_body_limit longest, again;
      if (sets[set] == FB_EFFECTS_LARGE && !FB_WITH_LARGE_DEFLECTION) {
        continue;
      }
      fbt_seed(17);
      craft(sets[set], (fb_base)base, 1);
      craft_moves(0.01);
      FBT_INT_EQ(fb_body_limit_eval(&body, &longest, &state, &input), FB_OK);
      before = state;
      for (int beyond = 0; beyond < 2; beyond++) {
        const double part = beyond ? 1.001 : 0.999;
        state = before;
        FBT_INT_EQ(step(FB_INTEGRATOR_RK4, part * (double)longest.rk4), beyond ? FB_ERR_STEP : FB_OK);
        state = before;
        FBT_INT_EQ(step(FB_INTEGRATOR_SDIRK, part * (double)longest.implicit), beyond ? FB_ERR_STEP : FB_OK);
      }
      again = longest;
      state = before;
      state.pi[body.n] = (fb_real)NAN;
      FBT_INT_EQ(fb_body_limit_eval(&body, &longest, &state, &input), FB_ERR_NOT_FINITE);
      FBT_TRUE(memcmp(&again, &longest, sizeof again) == 0);
    }
  }
}

/* ---- imbalance, given momenta */

/* E8.41, E11.46: a top that spins at 400 rad/s about its axis of symmetry moves as a body at rest about that axis with a
   rotor of the same momentum: steps in which the top would turn by 4 rad, refused without the rotor. */
TEST(fast_tops_are_bodies_with_rotors)
{
  const double A = 20.0, C = 0.7, own = 0.01, m = 4.0, l = 0.3, spin = 400.0, T = 1.0, wheel = C * spin / (C - own);
  const fb_real tilt[3] = {0, FB_R(1.1), 0}, still[3] = {0, 0, 0};
  fb_real axis[2][3], R[9];
  for (int with = 0; with < 2; with++) {
    const fb_real w[3] = {FB_R(0.1), 0, (fb_real)(with ? 0.0 : spin)};
    const double dt = with ? 0.01 : FBT_TOL(1e-4, 4e-4);
    fresh(FB_BASE_PINNED, FB_EFFECT_GRAVITY);
    desc.gravity[2] = -FB_R(9.81);
    if (with) {
      rotor_add(0, 0, 0, 1, C - own);
    }
    rigid_hub(m, l, A, A, with ? own : C);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    fb_quat_from_rotvec(state.quat, tilt);
    FBT_INT_EQ(fb_state_from_velocity(&body, &state, still, w, NULL), FB_OK);
    if (with) {
      FBT_INT_EQ(fb_state_rotor_set(&body, &state, 0, (fb_real)wheel, 0, NULL), FB_OK);
    } else {
      FBT_INT_EQ(step(FB_INTEGRATOR_RK4, 0.01), FB_ERR_STEP);
    }
    run(FB_INTEGRATOR_RK4, dt, (int)(T / dt + 0.5));
    fb_quat_to_mat33(R, state.quat);
    for (int i = 0; i < 3; i++) {
      axis[with][i] = R[3 * i + 2];
    }
  }
  FBT_NEAR_ABS(fbt_difference(axis[0], axis[1], 3), 0.0, FBT_TOL(1e-6, 1e-3));
  FBT_TRUE(fabs((double)axis[0][1]) > 1e-3); /* it has moved across */
}

/* E8.42: a heavy body is shaken by U spin^2 along a direction that turns: velocity U spin/m (sin, 1 - cos) of the mass
   center, angular velocity by the dynamic imbalance alike, a quarter of a turn ahead. */
TEST(unbalanced_rotors_shake_their_body)
{
  const double m = 1e4, J = 1e7, spin = 30.0, U_s = 0.02, U_d = 0.03, T = 0.3, phase = 0.5;
  fb_rotor *rotor;
  fresh(FB_BASE_FREE, 0);
  rotor = rotor_add(0, 0, 0, 1, 0.01);
  rotor->static_imbalance = (fb_real)U_s;
  rotor->dynamic_imbalance = (fb_real)U_d;
  rotor->dynamic_phase = (fb_real)phase;
  rigid_hub(m, 0.0, J, J, J);
  spin_up(0, 0, 0, &spin);
  FBT_INT_EQ(fb_state_rotor_set(&body, &state, 0, (fb_real)spin, FB_R(0.2), NULL), FB_OK);
  look();
  FBT_NEAR_REL(motion.acceleration[0], U_s * spin * spin / m * cos(0.2), FBT_TOL(1e-12, 1e-5));
  FBT_NEAR_REL(motion.acceleration[1], U_s * spin * spin / m * sin(0.2), FBT_TOL(1e-12, 1e-5));
  run(FB_INTEGRATOR_RK4, 1e-3, 300);
  look();
  FBT_NEAR_ABS(state.u[0] * FB_R(1e4), U_s * spin * (sin(spin * T + 0.2) - sin(0.2)), FBT_TOL(1e-7, 1e-3));
  FBT_NEAR_ABS(state.u[1] * FB_R(1e4), U_s * spin * (cos(0.2) - cos(spin * T + 0.2)), FBT_TOL(1e-7, 1e-3));
  FBT_NEAR_ABS(motion.w[0] * FB_R(1e7), U_d * spin * (sin(spin * T + 0.2 + phase) - sin(0.2 + phase)),
               FBT_TOL(1e-5, 1e-2));
  FBT_NEAR_ABS(motion.w[1] * FB_R(1e7), U_d * spin * (cos(0.2 + phase) - cos(spin * T + 0.2 + phase)),
               FBT_TOL(1e-5, 1e-2));
}

/* E8.42: a force that turns is the same from a rotor on a node that moves and from a load there that follows the
   node. */
TEST(imbalance_acts_as_a_load_on_its_node)
{
  for (int set = 0; set < FBT_COUNT(sets); set++) {
    fb_state rate, by_load;
    fb_real y[3], size;
    const fb_real angle = FB_R(0.7);
    if (sets[set] == FB_EFFECTS_LARGE && !FB_WITH_LARGE_DEFLECTION) {
      continue;
    }
    fbt_seed(16);
    craft(sets[set], FB_BASE_FREE, 0);
    craft_moves(0.03);
    FBT_INT_EQ(fb_state_rotor_set(&body, &state, 1, -FB_R(60.0), angle, NULL), FB_OK);
    fb_vec3_cross(y, body.rotor[1].axis, body.rotor[1].across);
    size = state.pi[body.n + 1] / body.rotor[1].inertia;
    size *= size * FB_R(0.002);
    input.n_load = 1;
    input.load[0].node = body.rotor[1].node;
    input.load[0].axes = FB_AXES_NODE;
    for (int i = 0; i < 3; i++) {
      input.load[0].force[i] =
          size * ((fb_real)cos((double)angle) * body.rotor[1].across[i] + (fb_real)sin((double)angle) * y[i]);
    }
    FBT_INT_EQ(fb_body_rates_eval(&body, &by_load, &state, &input), FB_OK);
    input.n_load = 0;
    desc.rotor[1].static_imbalance = FB_R(0.002);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
    FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, &input), FB_OK);
    FBT_NEAR_ABS(fbt_difference(rate.pi, by_load.pi, body.n), 0.0, FBT_TOL(1e-11, 1e-4));
    FBT_NEAR_ABS(fbt_difference(rate.u, by_load.u, 3), 0.0, FBT_TOL(1e-13, 1e-5));
    FBT_NEAR_ABS(fbt_difference(rate.L, by_load.L, 3), 0.0, FBT_TOL(1e-12, 1e-4));
  }
}

/* E8.41, E8.44: a momentum that is given: the rest of the body has what is left of the total, by every integrator. */
TEST(given_momenta_turn_the_body_against_them)
{
  const double J = 3.0, T = 1.0, h_end = 0.6;
  for (int integrator = 0; integrator < FB_INTEGRATOR_COUNT; integrator++) {
    const int steps = 200;
    fb_real angle;
    fb_status status = FB_OK;
    fresh(FB_BASE_FREE, 0);
    rotor_add(0, 0, 1, 0, 0.02)->given = 1;
    rigid_hub(10.0, 0.0, 1.0, J, 2.5);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_exponential_init(&exponential, &body_work, &body, (fb_real)(T / steps)), FB_OK);
    for (int k = 0; k < steps && status == FB_OK; k++) {
      static fb_input in[3];
      for (int i = 0; i < 3; i++) {
        memset(&in[i], 0, sizeof in[i]);
        in[i].rotor[0].momentum = (fb_real)(h_end * (k + 0.5 * i) / steps);
        in[i].rotor[0].torque = (fb_real)(h_end / T);
      }
      status = integrator == FB_INTEGRATOR_RK4
                   ? fb_rk4_step(&body, &state, &rk4, &in[0], &in[1], &in[2], (fb_real)(T / steps))
               : integrator == FB_INTEGRATOR_MIDPOINT
                   ? fb_midpoint_step(&body, &state, &implicit, &in[1], (fb_real)(T / steps), 0)
               : integrator == FB_INTEGRATOR_SDIRK
                   ? fb_sdirk_step(&body, &state, &implicit, &in[0], &in[2], (fb_real)(T / steps), 0)
                   : fb_exponential_step(&body, &exponential, &state, &exponential_work, &in[0], &in[1], &in[2]);
      input = in[2];
    }
    FBT_INT_EQ(status, FB_OK);
    look();
    angle = FB_R(2.0) * (fb_real)atan2((double)state.quat[2], (double)state.quat[0]);
    FBT_NEAR_REL(motion.w[1], -h_end / J, FBT_TOL(1e-12, 1e-5));
    FBT_NEAR_REL(motion.w_dot[1], -h_end / T / J, FBT_TOL(1e-12, 1e-5));
    FBT_NEAR_REL(angle, -0.5 * h_end * T / J, FBT_TOL(1e-7, 1e-4));
    FBT_NEAR_REL(motion.rotor_speed[0], h_end / 0.02 + h_end / J, FBT_TOL(1e-12, 1e-5));
    FBT_NEAR_ABS(fbt_largest(state.L, 3), 0.0, 0.0);
  }
}

/* ---- refusals */

static unsigned rotors_word(void)
{
  return fb_body_crc(&body);
}

/* E8.40: of rotors the word sees every byte but padding, and none of room that is not used; a number that is none is
   refused, and what may not be negative. */
TEST(the_check_word_of_rotors_sees_every_byte)
{
  const int pad = (int)(sizeof(fb_rotor) - 15 * sizeof(fb_real) - 3 * sizeof(int));
  fresh(FB_BASE_FREE, 0);
  rotor_add(0, 0, 0, 1, 0.1);
  rotor_add(0, 1, 0, 0, 0.2);
  rigid_hub(10.0, 0.0, 1.0, 1.0, 1.0);
  FBT_INT_EQ(fb_body_check(&body), FB_OK);
  FBT_INT_EQ(fbt_unseen(body.rotor, 2 * sizeof(fb_rotor), rotors_word) <= 2 * pad, 1);
  FBT_INT_EQ(fbt_unseen(&body.n_rotor, sizeof body.n_rotor, rotors_word), 0);
  for (int r = 0; r < 2; r++) {
    fb_rotor *const at = &body.rotor[r];
    fb_real *const number[] = {at->axis,      at->across,         &at->static_imbalance, &at->dynamic_imbalance,
                               &at->inertia,  &at->dynamic_phase, &at->damping,          &at->friction,
                               &at->mobility, &at->rate,          &at->friction_speed};
    for (int k = 0; k < FBT_COUNT(number); k++) {
      const fb_real was = *number[k];
      *number[k] = (fb_real)NAN;
      FBT_INT_EQ(fb_body_check(&body), FB_ERR_VALUE);
      *number[k] = -FB_R(1.0);
      FBT_INT_EQ(fb_body_check(&body), k < 4 || k == 5 ? FB_OK : FB_ERR_VALUE);
      *number[k] = was;
    }
  }
  FBT_INT_EQ(fb_body_check(&body), FB_OK);
}

/* Interface: what is wrong with a rotor is refused. */
TEST(bad_rotors_are_refused)
{
  static fb_body kept;
  const double speed = 1.0;
  fb_real nan_value = FB_R(0.0);
  nan_value = (fb_real)NAN;
  fresh(FB_BASE_FREE, 0);
  rotor_add(0, 0, 0, 1, 0.1);
  rigid_hub(10.0, 0.0, 1.0, 1.0, 1.0);
  kept = body;
  for (int k = 0; k < 13; k++) {
    static const fb_status expected[13] = {FB_ERR_CAPACITY,   FB_ERR_CAPACITY,   FB_ERR_CAPACITY, FB_ERR_CAPACITY,
                                           FB_ERR_VALUE,      FB_ERR_NOT_FINITE, FB_ERR_VALUE,    FB_ERR_VALUE,
                                           FB_ERR_NOT_FINITE, FB_ERR_VALUE,      FB_ERR_VALUE,    FB_ERR_VALUE,
                                           FB_ERR_NOT_FINITE};
    fb_body_desc bad = desc;
    bad.n_rotor = k == 0 ? -1 : k == 1 ? FB_MAX_ROTORS + 1 : bad.n_rotor;
    bad.rotor[0].node = k == 2 ? -1 : k == 3 ? 1 : 0;
    bad.rotor[0].axis[2] = k == 4 ? FB_R(0.0) : k == 5 ? nan_value : FB_R(1.0);
    bad.rotor[0].inertia = k == 6 ? FB_R(0.0) : k == 7 ? -FB_R(1.0) : k == 8 ? nan_value : FB_R(0.1);
    bad.rotor[0].damping = k == 9 ? -FB_R(1.0) : FB_R(0.0);
    bad.rotor[0].friction = k == 10 ? -FB_R(1.0) : k == 11 ? FB_R(1.0) : FB_R(0.0);
    bad.rotor[0].dynamic_phase = k == 12 ? nan_value : FB_R(0.0);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &bad), expected[k]);
    FBT_TRUE(memcmp(&body, &kept, sizeof body) == 0);
  }
  {
    fb_body_desc none = desc;
    none.n_rotor = 0;
    memset(none.rotor, 0, sizeof none.rotor);
    none.effects = FB_EFFECT_ROTORS;
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &none), FB_ERR_EFFECTS);
  }

  /* input, speeds */
  spin_up(0, 0, 0, &speed);
  before = state;
  input.rotor[0].momentum = FB_R(1.0);
  FBT_INT_EQ(step(FB_INTEGRATOR_RK4, 1e-3), FB_ERR_VALUE);
  input.rotor[0].momentum = FB_R(0.0);
  input.rotor[0].torque = nan_value;
  FBT_INT_EQ(step(FB_INTEGRATOR_RK4, 1e-3), FB_ERR_NOT_FINITE);
  FBT_INT_EQ(step(FB_INTEGRATOR_SDIRK, 1e-3), FB_ERR_NOT_FINITE);
  input.rotor[0].torque = FB_R(0.0);
  for (int r = 1; r < FB_MAX_ROTORS; r++) { /* a motor that is not there */
    for (int given = 0; given < 2; given++) {
      fb_real *const value = given ? &input.rotor[r].momentum : &input.rotor[r].torque;
      *value = FB_R(1.0);
      for (int i = 0; i < (int)FB_INTEGRATOR_COUNT; i++) {
        FBT_INT_EQ(step(i, 1e-3), FB_ERR_VALUE);
      }
      *value = FB_R(0.0);
    }
  }
  FBT_INT_EQ(fb_state_rotor_set(&body, &state, 1, 0, 0, NULL), FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_state_rotor_set(&body, &state, -1, 0, 0, NULL), FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_state_rotor_set(&body, &state, 0, nan_value, 0, NULL), FB_ERR_NOT_FINITE);
  FBT_INT_EQ(fb_state_rotor_set(&body, &state, 0, 0, nan_value, NULL), FB_ERR_NOT_FINITE);
  FBT_TRUE(memcmp(&before, &state, sizeof state) == 0);
  state.pi[0] = nan_value;
  FBT_INT_EQ(fb_state_check(&body, &state), FB_ERR_NOT_FINITE);

  /* a model that may have changed by itself */
  body.rotor[0].node = 7;
  FBT_INT_EQ(fb_body_check(&body), FB_ERR_VALUE);
  body = kept;
  body.n_rotor = 0;
  FBT_INT_EQ(fb_body_check(&body), FB_ERR_VALUE);
  body = kept;
  body.n_coordinate++;
  FBT_INT_EQ(fb_body_check(&body), FB_ERR_VALUE);
  body = kept;
  FBT_INT_EQ(fb_body_check(&body), FB_OK);
}

/* Interface: what has no rotors yet says so and leaves its output alone. */
TEST(rotors_are_refused_where_there_are_none)
{
  craft(FB_WITH_LARGE_DEFLECTION ? FB_EFFECTS_LARGE : FB_EFFECTS_FULL, FB_BASE_FREE, 0);
  craft_moves(0.01);
  look();
#if FB_WITH_LARGE_DEFLECTION
  {
    static fb_line_motion point[FB_MAX_LINE_POINTS];
    fb_node_loads loads;
    int n = 0;
    FBT_INT_EQ(fb_body_lines_eval(&body, point, &n, &state, &motion, &input), FB_ERR_UNSUPPORTED);
    FBT_INT_EQ(fb_body_node_loads_eval(&body, &loads, &state, &motion, &input, desc.rotor[1].node), FB_ERR_UNSUPPORTED);
  }
#endif
}

SUITE(body_rotors, RUN(gyrostats_nutate_and_wobble_in_closed_form), RUN(gyroscopes_precess_in_closed_form),
      RUN(asymmetric_gyrostats_spin_steadily), RUN(motors_and_friction_act_between_wheel_and_body),
      RUN(momenta_of_rotors_are_those_of_their_sections), RUN(gyrostats_keep_energy_and_momentum),
      RUN(power_of_rotors_is_the_rate_of_energy), RUN(accelerations_of_gyrostats_are_derivatives_of_velocities),
      RUN(integrators_of_gyrostats_agree), RUN(wheels_at_600_rad_per_s_cost_no_step), RUN(rotors_bound_the_step),
      RUN(steps_of_one_body_are_those_of_its_limit), RUN(fast_tops_are_bodies_with_rotors),
      RUN(unbalanced_rotors_shake_their_body), RUN(imbalance_acts_as_a_load_on_its_node),
      RUN(given_momenta_turn_the_body_against_them), RUN(the_check_word_of_rotors_sees_every_byte),
      RUN(bad_rotors_are_refused), RUN(rotors_are_refused_where_there_are_none))
#endif
