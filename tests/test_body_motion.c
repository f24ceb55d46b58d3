/* >>body and >>assemble: loads, nodes, bases, energy, damping, spinning beams. */
#include "body.h"

/* ---- a boom with everything on it */

/* E8.15, E8.16, E8.21: the work of the loads, less damping, is the change of energy: an identity of the rates. */
TEST(power_of_loads_is_the_rate_of_energy)
{
  static const fb_base base[] = {FB_BASE_FREE, FB_BASE_PINNED, FB_BASE_HINGED};
  int node[2];
  for (int k = 0; k < 9; k++) {
    fb_state state;
    fb_input input;
    boom_body(FB_EFFECTS_FULL | FB_EFFECT_GRAVITY, base[k / 3], node);
    boom_state(&state, 0.05);
    memset(&input, 0, sizeof input);
    input.n_load = 2;
    for (int i = 0; i < 2; i++) {
      input.load[i].node = node[i];
      input.load[i].axes = (fb_axes)(k % 3);
      fbt_fill(input.load[i].force, 3, 2.0);
      fbt_fill(input.load[i].torque, 3, 1.0);
    }
    FBT_NEAR_ABS(energy_rate(&state, &input, FBT_TOL(1e-5, 1e-2)), power_of(&state, &input), FBT_TOL(1e-7, 5e-2));
  }
}

/* ---- as many coordinates, nodes and loads as there can be */

/* E8.22, E8.19: a free body with the reactions of its base as loads at O moves as the held one does. */
TEST(a_held_body_is_a_free_one_with_its_reactions)
{
  static const fb_base base[] = {FB_BASE_PINNED, FB_BASE_HINGED};
  int node[2];
  for (int k = 0; k < 2; k++) {
    fb_state held, loose;
    fb_motion motion, free_motion;
    fb_input input;
    fb_real qd[BOOM_MODES], v[3], w[3];
    boom_body(FB_EFFECTS_FULL | FB_EFFECT_GRAVITY, base[k], node);
    boom_state(&held, 0.05);
    memset(&input, 0, sizeof input);
    input.n_load = 1;
    input.load[0].node = node[0];
    fbt_fill(input.load[0].force, 3, 2.0);
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &held, &input), FB_OK);
    FBT_TRUE(fbt_largest(motion.reaction_force, 3) > 0.1 && fbt_largest(motion.acceleration, 3) == 0.0);
    FBT_TRUE((fbt_largest(motion.reaction_torque, 3) > 0.1) == (base[k] == FB_BASE_HINGED));
    FBT_TRUE(motion.reaction_torque[2] == FB_R(0.0)); /* what is free has none, not even rounding */
    FBT_TRUE((fbt_largest(motion.reaction_torque, 2) == 0.0) == (base[k] == FB_BASE_PINNED));
    boom_body(FB_EFFECTS_FULL | FB_EFFECT_GRAVITY, FB_BASE_FREE, node);
    loose = held;
    memcpy(v, motion.v, sizeof v);
    memcpy(w, motion.w, sizeof w);
    memcpy(qd, motion.q_dot, sizeof qd);
    FBT_INT_EQ(fb_state_from_velocity(&body, &loose, v, w, qd), FB_OK);
    input.n_load = 2;
    input.load[1].axes = FB_AXES_BODY;
    memcpy(input.load[1].force, motion.reaction_force, sizeof input.load[1].force);
    memcpy(input.load[1].torque, motion.reaction_torque, sizeof input.load[1].torque);
    FBT_INT_EQ(fb_body_motion_eval(&body, &free_motion, &loose, &input), FB_OK);
    FBT_TRUE(fbt_largest(free_motion.reaction_force, 3) == 0.0 && fbt_largest(free_motion.reaction_torque, 3) == 0.0);
    FBT_BELOW(fbt_difference(free_motion.acceleration, motion.acceleration, 3), FBT_TOL(1e-12, 1e-3));
    FBT_BELOW(fbt_difference(free_motion.w_dot, motion.w_dot, 3), FBT_TOL(1e-12, 1e-3));
    FBT_BELOW(fbt_difference(free_motion.q_ddot, motion.q_ddot, BOOM_MODES), FBT_TOL(1e-11, 1e-2));
  }
}

/* E8.22: a rigid pendulum from 1 rad is at the bottom after a quarter of 2 pi / (omega_0 agm(1, cos 1/2)); pinned and
   hinged. */
TEST(pinned_and_hinged_bodies_swing_as_rigid_pendulums)
{
  static const fb_real center[3] = {FB_R(0.5), 0, 0}, inertia[6] = {FB_R(0.1), FB_R(0.2), FB_R(0.25)};
  const double start = 1.0, J = 0.25 + 2.0 * 0.25, omega = sqrt(2.0 * 9.0 * 0.5 / J);
  double a = 1.0, g = cos(0.5 * start), quarter;
  for (int k = 0; k < 6; k++) {
    const double mean = 0.5 * (a + g);
    g = sqrt(a * g);
    a = mean;
  }
  quarter = 0.5 * 3.14159265358979323846 / (omega * a);
  for (int k = 0; k < 2; k++) {
    static fb_body_desc desc;
    fb_state state;
    fb_rk4_work work;
    fb_motion motion;
    const fb_real turn[3] = {0, 0, (fb_real)start};
    memset(&desc, 0, sizeof desc);
    desc.base = k ? FB_BASE_PINNED : FB_BASE_HINGED;
    desc.effects = FB_EFFECT_GRAVITY;
    desc.gravity[0] = FB_R(9.0);
    FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(2.0), center, inertia), FB_OK);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    fb_quat_from_rotvec(state.quat, turn);
    for (int i = 0; i < 1000; i++) {
      FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, (fb_real)(quarter / 1000.0)), FB_OK);
    }
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, NULL), FB_OK);
    FBT_NEAR_ABS(state.quat[3], 0.0, FBT_TOL(1e-12, 1e-5));
    FBT_NEAR_REL(motion.w[2], -2.0 * omega * sin(0.5 * start), FBT_TOL(1e-11, 1e-5));
    FBT_NEAR_REL(motion.reaction_force[0], -(2.0 * 9.0 + 2.0 * 0.5 * pow(2.0 * omega * sin(0.5 * start), 2.0)),
                 FBT_TOL(1e-11, 1e-5));
    { /* a velocity that the base holds is refused */
      const fb_real v[3] = {0, 1, 0}, w[3] = {1, 0, 0}, none[3] = {0};
      FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, none, NULL), FB_ERR_VALUE);
      FBT_INT_EQ(fb_state_from_velocity(&body, &state, none, w, NULL), k ? FB_OK : FB_ERR_VALUE);
    }
  }
}

/* Defects of velocity, acceleration, angular rate and angular acceleration of a node at the middle of two rk4 steps of
   h against central differences of its pose (and rate). */
static void node_defects(double defect[4], double h, int node)
{
  fb_state state;
  fb_rk4_work work;
  fb_motion motion;
  fb_node_motion at[3];
  fb_real turn[4], spin[3];
  boom_state(&state, 0.02);
  for (int k = 0; k < 40; k++) { /* so that the middle is at 0.1 s for every h */
    FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, (fb_real)((0.1 - h) / 40.0)), FB_OK);
  }
  for (int k = 0; k < 3; k++) {
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, NULL), FB_OK);
    FBT_INT_EQ(fb_body_node_motion_eval(&body, &at[k], &state, &motion, node), FB_OK);
    FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, (fb_real)h), FB_OK);
  }
  {
    const fb_real back[4] = {at[0].quat[0], -at[0].quat[1], -at[0].quat[2], -at[0].quat[3]};
    fb_quat_mul(turn, at[2].quat, back);
    fb_quat_to_rotvec(spin, turn);
  }
  memset(defect, 0, 4 * sizeof defect[0]);
  for (int i = 0; i < 3; i++) {
    const double x0 = (double)at[0].position[i], x1 = (double)at[1].position[i], x2 = (double)at[2].position[i];
    const double dw = (double)at[2].angular_rate[i] - (double)at[0].angular_rate[i];
    defect[0] = fmax(defect[0], fabs((x2 - x0) / (2.0 * h) - (double)at[1].velocity[i]));
    defect[1] = fmax(defect[1], fabs((x2 - 2.0 * x1 + x0) / (h * h) - (double)at[1].acceleration[i]));
    defect[2] = fmax(defect[2], fabs((double)spin[i] / (2.0 * h) - (double)at[1].angular_rate[i]));
    defect[3] = fmax(defect[3], fabs(dw / (2.0 * h) - (double)at[1].angular_acceleration[i]));
  }
}

/* E8.16, E8.21: the energy of gravity is that of the particles in their places, and so is that of the strain, whatever
   else moves; without gravity there is none. */
TEST(potential_energies_agree_with_a_particle_model)
{
  const int n = 5;
  particles_random(&cloud, n, 1);
  particles_to_shape(&shape, &cloud);
  fbt_fill(shape.K, n * n, 0.5);
  for (int ab = 0; ab < n * n; ab++) {
    const int ba = ab % n * n + ab / n;
    shape.K[ab] = ab == ba ? FB_R(5.0) : ab > ba ? shape.K[ba] : shape.K[ab];
  }
  for (int falls = 0; falls < 2; falls++) {
    double gravity = 0.0, strain = 0.0;
    fb_body_desc level;
    fb_state state;
    fb_energy energy;
    velocity s;
    fb_real R[9];
    memset(&level, 0, sizeof level);
    level.effects = FB_EFFECTS_FULL | (falls ? FB_EFFECT_GRAVITY : 0);
    fbt_fill(level.gravity, 3, 5.0);
    fbt_fit(&level);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
    velocity_random(&s, n, 0.1);
    state_from(&state, &body, &s);
    fbt_fill(state.rho, 3, 2.0);
    fbt_fill(state.quat, 4, 1.0);
    FBT_INT_EQ(fb_quat_normalize(state.quat), FB_OK);
    fb_quat_to_mat33(R, state.quat);
    for (int i = 0; i < PARTICLES; i++) {
      double x[3], J[MAX_N][3], xd[3];
      particle_at(x, J, xd, &cloud, i, &s);
      for (int k = 0; k < 3; k++) {
        const double at =
            (double)state.rho[k] + (double)R[3 * k] * x[0] + (double)R[3 * k + 1] * x[1] + (double)R[3 * k + 2] * x[2];
        gravity -= falls * cloud.m[i] * (double)level.gravity[k] * at;
      }
    }
    for (int ab = 0; ab < n * n; ab++) {
      strain += 0.5 * s.q[ab / n] * (double)shape.K[ab] * s.q[ab % n];
    }
    FBT_INT_EQ(fb_body_energy_eval(&body, &energy, &state, NULL), FB_OK);
    FBT_NEAR_ABS(energy.gravity, gravity, FBT_TOL(1e-11, 1e-2));
    FBT_NEAR_ABS(energy.strain, strain, FBT_TOL(1e-14, 1e-6));
  }
}

/* E8.7: a particle on a spring: the damping force is 2 zeta sqrt(k m) times its speed, soft or stiff, in any unit of
   its coordinate. */
TEST(damping_is_that_of_a_particle_on_a_spring)
{
  for (int run = 0; run < 9; run++) {
    const double k = pow(10.0, 3.0 * (run % 3 - 1)), m = run / 3 == 0 ? 1.0 : 0.01 * run, zeta = 0.05;
    const fb_real r[3] = {0}, psi[3] = {0, 1}, none[3] = {0}, q_dot = FB_R(2.0);
    fb_body_desc level;
    fb_state state, rate;
    memset(&level, 0, sizeof level);
    level.effects = FB_EFFECTS_LINEAR | FB_EFFECT_DAMPING;
    level.base = FB_BASE_PRESCRIBED;
    level.zeta[0] = (fb_real)zeta;
    FBT_INT_EQ(fb_shape_init(&shape, 1), FB_OK);
    FBT_INT_EQ(fb_shape_add_particle(&shape, (fb_real)m, r, psi, NULL), FB_OK);
    shape.K[0] = (fb_real)k;
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_state_from_velocity(&body, &state, none, none, &q_dot), FB_OK);
    FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, NULL), FB_OK);
    FBT_NEAR_REL(rate.pi[0], -2.0 * zeta * sqrt(k * m) * 2.0, FBT_TOL(1e-13, 1e-5));
    FBT_NEAR_REL(body.limit_damping, 2.0 * zeta * sqrt(k / m), FBT_TOL(1e-13, 1e-5));
    FBT_NEAR_REL(body.limit_elastic, k / m, FBT_TOL(1e-13, 1e-5));
  }
}

/* Particles with as many nodes as there can be, all that they have random, and the body of it. */
static void random_nodes(int n)
{
  fb_body_desc desc;
  memset(&desc, 0, sizeof desc);
  desc.effects = FB_EFFECTS_FULL;
  particles_random(&cloud, n, 1);
  particles_to_shape(&shape, &cloud);
  shape.n_node = FB_MAX_NODES;
  for (int k = 0; k < FB_MAX_NODES; k++) {
    fb_node *at = &shape.node[k];
    fbt_fill(at->r, 3, 1.0);
    fbt_fill(at->psi, 3 * n, 1.0);
    fbt_fill(at->theta, 3 * n, 1.0);
    fbt_fill(at->chi, 3 * n * (n + 1) / 2, 1.0);
    fbt_fill(at->chi_theta, 3 * n * (n + 1) / 2, 1.0);
  }
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
}

/* E8.14: a body's nodes are those of its shape, every number of them. */
TEST(nodes_are_those_of_the_shape)
{
  const int n = 3, pairs = 3 * n * (n + 1) / 2;
  random_nodes(n);
  FBT_INT_EQ(body.n_node, FB_MAX_NODES);
  for (int k = 0; k < FB_MAX_NODES; k++) {
    const fb_node *at = &body.node[k], *from = &shape.node[k];
    FBT_TRUE(fbt_difference(at->r, from->r, 3) == 0.0);
    FBT_TRUE(fbt_difference(at->psi, from->psi, 3 * n) == 0.0);
    FBT_TRUE(fbt_difference(at->theta, from->theta, 3 * n) == 0.0);
    FBT_TRUE(fbt_difference(at->chi, from->chi, pairs) == 0.0);
    FBT_TRUE(fbt_difference(at->chi_theta, from->chi_theta, pairs) == 0.0);
  }
}

/* E8.14, E8.20, E8.30: of nodes that turn by a radian and more, on a frame that stands still, velocity and acceleration
   are the differences of position and velocity, angular rate and acceleration those of attitude and angular rate. */
TEST(nodes_that_turn_far_have_the_rates_of_their_pose)
{
  const int n = 3;
  const double h = FBT_TOL(1e-4, 1e-2);
  double turned = 0.0;
  random_nodes(n);
  for (int node = 1; node < FB_MAX_NODES; node++) {
    fb_node_motion at[3];
    fb_real back[4], turn[4], spin[3];
    fb_motion motion;
    fb_state state;
    memset(&motion, 0, sizeof motion);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    fbt_fill(state.q, n, 0.7);
    fbt_fill(motion.q_dot, n, 0.7);
    fbt_fill(motion.q_ddot, n, 0.7);
    for (int k = 0; k < 3; k++) {
      fb_state then = state;
      fb_motion moves = motion;
      for (int a = 0; a < n; a++) {
        const double t = (k - 1) * h;
        then.q[a] += (fb_real)(t * (double)motion.q_dot[a] + 0.5 * t * t * (double)motion.q_ddot[a]);
        moves.q_dot[a] += (fb_real)(t * (double)motion.q_ddot[a]);
      }
      FBT_INT_EQ(fb_body_node_motion_eval(&body, &at[k], &then, &moves, node), FB_OK);
    }
    for (int i = 0; i < 4; i++) {
      back[i] = i ? -at[0].quat[i] : at[0].quat[0];
    }
    fb_quat_mul(turn, at[2].quat, back);
    fb_quat_to_rotvec(spin, turn);
    turned = fmax(turned, fbt_largest(at[1].rotation, 3));
    for (int i = 0; i < 3; i++) {
      const double v = (double)(at[2].position[i] - at[0].position[i]),
                   a = (double)(at[2].velocity[i] - at[0].velocity[i]);
      const double w_dot = (double)(at[2].angular_rate[i] - at[0].angular_rate[i]);
      FBT_NEAR_ABS(at[1].velocity[i], v / (2.0 * h), FBT_TOL(1e-6, 3e-3));
      FBT_NEAR_ABS(at[1].acceleration[i], a / (2.0 * h), FBT_TOL(1e-6, 3e-3));
      FBT_NEAR_ABS(at[1].angular_rate[i], (double)spin[i] / (2.0 * h), FBT_TOL(1e-6, 3e-3));
      FBT_NEAR_ABS(at[1].angular_acceleration[i], w_dot / (2.0 * h), FBT_TOL(1e-6, 3e-3));
    }
  }
  FBT_TRUE(turned > 1.0);
}

/* E8.14, E8.20. The attitude of a node is exact to second degree of the deflection, its rate to first. */
TEST(node_kinematics_match_finite_differences)
{
  int node[2];
  boom_body(FB_EFFECTS_FULL | FB_EFFECT_GRAVITY | FB_EFFECT_DAMPING, FB_BASE_FREE, node);
  for (int k = 0; k < 3; k++) {
    double coarse[4], fine[4];
    const int which = k ? node[k - 1] : 0;
    fbt_seed(7);
    node_defects(coarse, FBT_TOL(2e-3, 4e-2), which);
    fbt_seed(7);
    node_defects(fine, FBT_TOL(1e-3, 2e-2), which);
    FBT_BELOW(fine[0], FBT_TOL(1e-4, 2e-2));
    FBT_BELOW(fine[1], FBT_TOL(5e-4, 0.2));
    FBT_BELOW(fine[2], FBT_TOL(2e-3, 5e-2));
    FBT_DOUBLE_ONLY("its step leaves 0.4 rad/s^2")
    {
      FBT_BELOW(fine[3], 3e-3);
    }
    for (int i = 0; i < 4; i++) { /* what the step does not leave is wrong */
      FBT_NEAR_ABS(coarse[i] / fine[i], 4.0, FBT_TOL(0.01, 0.5));
    }
  }
}

/* E8.19: force and torque of a prescribed base are the rates of momentum about the moving origin, less gravity and
   loads. */
TEST(reactions_balance_the_momentum)
{
  int node[2];
  const double h = FBT_TOL(1e-4, 2e-3);
  fb_state state;
  fb_rk4_work work;
  fb_motion motion;
  fb_momentum momentum[2];
  fb_input input[3];
  fb_real R[9], F[3], T[3], rate[3], gravity[3] = {FB_R(0.3), 0, -FB_R(1.5)}, load[3];
  fb_node_motion at;
  fb_state center_state;
  boom_body(FB_EFFECTS_FULL | FB_EFFECT_GRAVITY, FB_BASE_PRESCRIBED, node);
  boom_state(&state, 0.05);
  memset(&center_state, 0, sizeof center_state);
  memset(input, 0, sizeof input);
  for (int k = 0; k < 3; k++) { /* v = v0 + t v_dot at t = -h, 0, h */
    for (int i = 0; i < 3; i++) {
      input[k].v_dot[i] = (fb_real)(0.4 - 0.3 * i);
      input[k].w_dot[i] = (fb_real)(0.2 * i - 0.3);
      input[k].v[i] = (fb_real)(0.5 * i) + (fb_real)((k - 1) * h) * input[k].v_dot[i];
      input[k].w[i] = (fb_real)(0.7 - 0.2 * i) + (fb_real)((k - 1) * h) * input[k].w_dot[i];
    }
    input[k].n_load = 1;
    input[k].load[0].node = node[0];
    input[k].load[0].force[0] = FB_R(0.7);
    input[k].load[0].force[1] = -FB_R(0.4);
    input[k].load[0].torque[2] = FB_R(0.1);
  }
  FBT_INT_EQ(fb_body_momentum_eval(&body, &momentum[0], &state, &input[0]), FB_OK);
  {
    fb_input half[3]; /* two steps of h: ends and middles of the motion */
    for (int s = 0; s < 2; s++) {
      half[0] = input[s];
      half[2] = input[s + 1];
      half[1] = input[s];
      for (int i = 0; i < 3; i++) {
        half[1].v[i] = FB_R(0.5) * (half[0].v[i] + half[2].v[i]);
        half[1].w[i] = FB_R(0.5) * (half[0].w[i] + half[2].w[i]);
      }
      if (s == 1) {
        center_state = state;
        FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &input[1]), FB_OK);
        FBT_INT_EQ(fb_body_node_motion_eval(&body, &at, &state, &motion, node[0]), FB_OK);
        fb_quat_to_mat33(R, state.quat);
        fb_mat33_mul_vec3(F, R, motion.reaction_force);
        fb_mat33_mul_vec3(T, R, motion.reaction_torque);
        fb_vec3_cross(load, state.rho, F);
        for (int i = 0; i < 3; i++) { /* about the inertial origin */
          T[i] += load[i];
          F[i] += body.mass * gravity[i] + input[1].load[0].force[i];
        }
        fb_vec3_cross(load, at.position, input[1].load[0].force);
        for (int i = 0; i < 3; i++) {
          T[i] += load[i] + input[1].load[0].torque[i];
        }
      }
      FBT_INT_EQ(fb_rk4_step(&body, &state, &work, &half[0], &half[1], &half[2], (fb_real)h), FB_OK);
    }
  }
  FBT_INT_EQ(fb_body_momentum_eval(&body, &momentum[1], &state, &input[2]), FB_OK);
  for (int i = 0; i < 3; i++) {
    rate[i] = (momentum[1].linear[i] - momentum[0].linear[i]) / (fb_real)(2.0 * h);
  }
  FBT_BELOW(fbt_difference(rate, F, 3), FBT_TOL(1e-4, 0.2));
  /* the torque of gravity about the inertial origin, from its energy */
  {
    fb_energy up, down;
    for (int i = 0; i < 3; i++) { /* -dV/d(angle) about inertial axis i */
      fb_state turned[2];
      for (int s = 0; s < 2; s++) {
        fb_real phi[3] = {0}, quat[4], Q[9];
        turned[s] = center_state;
        phi[i] = s ? FBT_TOL(FB_R(1e-4), FB_R(1e-2)) : -FBT_TOL(FB_R(1e-4), FB_R(1e-2));
        fb_quat_from_rotvec(quat, phi);
        fb_quat_mul(turned[s].quat, quat, center_state.quat);
        fb_quat_to_mat33(Q, quat);
        fb_mat33_mul_vec3(turned[s].rho, Q, center_state.rho);
      }
      FBT_INT_EQ(fb_body_energy_eval(&body, &down, &turned[0], &input[1]), FB_OK);
      FBT_INT_EQ(fb_body_energy_eval(&body, &up, &turned[1], &input[1]), FB_OK);
      T[i] -= (up.gravity - down.gravity) / FBT_TOL(FB_R(2e-4), FB_R(2e-2));
      rate[i] = (momentum[1].angular[i] - momentum[0].angular[i]) / (fb_real)(2.0 * h);
    }
  }
  FBT_BELOW(fbt_difference(rate, T, 3), FBT_TOL(2e-4, 5e-2));
}

/* E8.16: in free fall from rest nothing bends, and the fall is g t^2 / 2; with any attitude. */
TEST(a_falling_body_does_not_deform)
{
  int node[2];
  fb_state state;
  fb_rk4_work work;
  boom_body(FB_EFFECTS_FULL | FB_EFFECT_GRAVITY | FB_EFFECT_DAMPING, FB_BASE_FREE, node);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  fbt_fill(state.quat, 4, 1.0);
  FBT_INT_EQ(fb_quat_normalize(state.quat), FB_OK);
  for (int k = 0; k < 1000; k++) {
    FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, FB_R(0.002)), FB_OK);
  }
  FBT_BELOW(fbt_largest(state.q, BOOM_MODES), FBT_TOL(1e-12, 1e-4));
  FBT_NEAR_ABS(state.rho[2], -0.5 * 1.5 * 4.0, FBT_TOL(1e-11, 1e-4));
  FBT_NEAR_ABS(state.rho[0], 0.5 * 0.3 * 4.0, FBT_TOL(1e-11, 1e-4));
}

/* Difference of the elastic response after 1 s between a motion and the same one in a turned and displaced frame that
   moves with the speed drift. */
static double frame_difference(double speed, double dt)
{
  fb_state state[2];
  fb_rk4_work work;
  fb_input input[2];
  fb_motion motion;
  fb_real turn[4], Q[9], R[9], drift[3], v[3];
  boom_state(&state[0], 0.1);
  state[1] = state[0];
  fbt_fill(turn, 4, 1.0);
  fbt_fill(drift, 3, speed);
  FBT_INT_EQ(fb_quat_normalize(turn), FB_OK);
  fb_quat_to_mat33(Q, turn);
  fb_quat_mul(state[1].quat, turn, state[0].quat);
  fb_mat33_mul_vec3(state[1].rho, Q, state[0].rho);
  state[1].rho[1] += FB_R(5.0);
  FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state[0], NULL), FB_OK);
  fb_quat_to_mat33(R, state[1].quat);
  fb_mat33_mulT_vec3(v, R, drift);
  for (int i = 0; i < 3; i++) {
    v[i] += motion.v[i];
  }
  FBT_INT_EQ(fb_state_from_velocity(&body, &state[1], v, motion.w, motion.q_dot), FB_OK);
  memset(input, 0, sizeof input);
  input[0].n_load = 1;
  input[0].load[0].node = 1;
  fbt_fill(input[0].load[0].force, 3, 0.5);
  input[1] = input[0];
  fb_mat33_mul_vec3(input[1].load[0].force, Q, input[0].load[0].force); /* dead load: turned with the frame */
  for (int k = 0; k < (int)(1.0 / dt + 0.5); k++) {
    for (int f = 0; f < 2; f++) {
      FBT_INT_EQ(fb_rk4_step(&body, &state[f], &work, &input[f], &input[f], &input[f], (fb_real)dt), FB_OK);
    }
  }
  FBT_TRUE(fbt_largest(state[0].q, BOOM_MODES) > 0.01);
  return fbt_difference(state[0].q, state[1].q, BOOM_MODES);
}

/* E8.13 to E8.18: in a turned and displaced frame the elastic response is the same to rounding with any step; in one
   that moves, to the truncation error of the integrator, which at a small step is rounding, too. */
TEST(elastic_response_is_frame_indifferent)
{
  int node[2];
  double coarse, fine;
  boom_body(FB_EFFECTS_FULL | FB_EFFECT_DAMPING, FB_BASE_FREE, node);
  fbt_seed(3);
  FBT_BELOW(frame_difference(0.0, 0.01), FBT_TOL(1e-13, 1e-4));
  fbt_seed(3);
  coarse = frame_difference(3.0, 0.002);
  fbt_seed(3);
  fine = frame_difference(3.0, 0.00025);
  fbt_figure("elastic response in a turned, moving frame", "frame indifference", fine);
  FBT_BELOW(fine, FBT_TOL(3e-13, 1e-3));
  FBT_BELOW(coarse, FBT_TOL(1e-9, 1e-3));
}

/* E8.7: free decay of one mode of a held body: the peaks fall by exp(-2 pi zeta / sqrt(1 - zeta^2)); with
   finite-element coordinates (full M) the same. */
TEST(damped_free_decay_has_the_given_ratio)
{
  static fb_modes_desc keep;
  static fb_body_desc desc;
  int node[2];
  keep.basis = FB_BASIS_ELEMENTS;
  keep.count[FB_KIND_BEND_Y] = 1;
  boom(&shape, node);
  for (int full = 0; full < 2; full++) {
    fb_state state;
    fb_rk4_work work;
    double zeta, omega, t;
    const int steps = 4000;
    if (full) {
      beam_desc.n_element = 3;
      beam_desc.n_lump = 0;
      memset(beam_desc.lump, 0, sizeof beam_desc.lump);
      FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
      FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
      FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
      FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
    }
    memset(&desc, 0, sizeof desc);
    desc.effects = FB_EFFECTS_LINEAR | FB_EFFECT_DAMPING;
    desc.base = FB_BASE_PRESCRIBED;
    for (int k = 0; k < shape.n; k++) {
      desc.zeta[k] = FB_R(0.05);
    }
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
    FBT_INT_EQ(body.unit_mass && body.K.n_term == 0, !full);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    if (full) { /* along the first eigenvector */
      static fb_real K[FB_MAX_MODES * FB_MAX_MODES], M[FB_MAX_MODES * FB_MAX_MODES], X[FB_MAX_MODES * FB_MAX_MODES];
      fb_real d[FB_MAX_MODES];
      memcpy(K, shape.K, sizeof K);
      memcpy(M, shape.M, sizeof M);
      FBT_INT_EQ(fb_eig_gen_solve(d, X, K, M, shape.n), FB_OK);
      omega = sqrt((double)d[0]);
      for (int a = 0; a < shape.n; a++) {
        state.q[a] = FB_R(0.1) * X[a];
      }
    } else {
      omega = (double)modes.omega[0];
      state.q[0] = FB_R(0.1);
    }
    zeta = 0.05;
    t = 2.0 * 3.14159265358979324 / (omega * sqrt(1.0 - zeta * zeta)); /* one damped period from rest: a peak again */
    {
      const fb_real before = state.q[0];
      for (int k = 0; k < steps; k++) {
        FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, (fb_real)(t / steps)), FB_OK);
      }
      FBT_NEAR_REL(state.q[0] / before, exp(-zeta * omega * t), FBT_TOL(1e-9, 1e-3));
    }
  }
}

/* Unit cantilever, uniform or of half the height at the tip: mass h, EI h^3; the cubic lies above its chords by 1/8 of
   its curvature, which the station values give back on average. */
static void rotor_blade(int tapered)
{
  const double chord = 1.0 / (FB_MAX_STATIONS - 1);
  memset(&beam_desc, 0, sizeof beam_desc);
  beam_desc.length = FB_R(1.0);
  beam_desc.n_element = 10;
  beam_desc.n_station = tapered ? FB_MAX_STATIONS : 1;
  for (int k = 0; k < beam_desc.n_station; k++) {
    const double x = tapered ? k * chord : 0.0, h = 1.0 - 0.5 * x, cut = tapered ? chord * chord / 8.0 : 0.0;
    fb_section *st = &beam_desc.station[k];
    st->x = (fb_real)x;
    st->mass = (fb_real)h;
    st->EI_y = st->EI_z = (fb_real)(h * (h * h - cut));
  }
}

/* Worst relative error of the first flap and lag frequencies for eta = 0..12 and three hub radii: eight bending modes,
   one body for all spins; stiffness about the steady spin by exact differences. */
static double spinning_error(const char *file, int tapered)
{
  const fbt_table *table = fbt_reference(file);
  static const double radius[] = {0.0, 0.1, 1.0};
  static fb_body_desc desc;
  fb_modes_desc keep;
  double worst = 0.0;
  for (int r = 0; r < FBT_COUNT(radius); r++) {
    rotor_blade(tapered);
    beam_desc.position[0] = (fb_real)radius[r];
    memset(&desc, 0, sizeof desc);
    desc.effects = FB_EFFECTS_FULL;
    desc.base = FB_BASE_PRESCRIBED;
    memset(&keep, 0, sizeof keep);
    keep.spin = FB_R(12.0);
    keep.spin_radius = (fb_real)radius[r];
    FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
    for (int plane = 0; plane < 2; plane++) { /* the axis of spin is z: y is lag, z is flap */
      keep.count[FB_KIND_BEND_Y] = plane ? 0 : 8;
      keep.count[FB_KIND_BEND_Z] = plane ? 8 : 0;
      FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
      FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
      FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
      FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
      for (int row = 0; row < table->rows; row++) {
        const double eta = fbt_value(table, row, "eta");
        fb_real K[64], V[64], omega2[8];
        fb_input input;
        if (fbt_value(table, row, "alpha") != radius[r] || eta > 12.0 || fbt_value(table, row, "mode") != 1.0) {
          continue;
        }
        memset(&input, 0, sizeof input);
        input.w[2] = (fb_real)eta;
        for (int b = 0; b < 8; b++) {
          fb_state state, rate[2];
          for (int side = 0; side < 2; side++) {
            FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
            state.q[b] = side ? FB_R(0.5) : -FB_R(0.5);
            FBT_INT_EQ(fb_state_from_velocity(&body, &state, input.v, input.w, NULL), FB_OK);
            FBT_INT_EQ(fb_body_rates_eval(&body, &rate[side], &state, &input), FB_OK);
          }
          for (int a = 0; a < 8; a++) {
            K[a * 8 + b] = rate[0].pi[a] - rate[1].pi[a];
          }
        }
        FBT_INT_EQ(fb_eig_sym_solve(omega2, V, K, 8), FB_OK);
        {
          const double error =
              fabs(sqrt((double)omega2[0]) / fbt_value(table, row, plane ? "mu_flap" : "mu_lag") - 1.0);
          worst = fmax(worst, error);
        }
      }
    }
  }
  return worst;
}

/* E8.2, E8.12, E7.4, E6.6: rotating cantilevers (Wright et al. 1982; Hodges and Rutkowski 1981;
   tests/reference/p02). */
TEST(spinning_beams_stiffen_as_published)
{
  const double uniform = spinning_error("p02_rotating_uniform.csv", 0);
  const double tapered = spinning_error("p02_rotating_tapered.csv", 1);
  fbt_figure("rotating cantilever, first flap and lag, eta 0..12", "power series (p02; Wright et al. 1982)", uniform);
  fbt_figure("the same, tapered", "power series (p02; Hodges and Rutkowski 1981)", tapered);
  FBT_BELOW(uniform, FBT_TOL(1e-6, 2e-3));
  FBT_BELOW(tapered, FBT_TOL(1e-5, 2e-3));
}

/* Worst relative error of the first four flap and lag frequencies, eta = 0..50 and three hub radii, of the eigenvalues
   of the linear model about the steady spin: 20 bending modes of 20 elements (the mesh errs by 1e-6 at eta = 50), one
   body for all spins. */
static double linear_spinning_error(const char *file, int tapered)
{
  static fb_analyse_work analyse_work;
  static fb_spectrum spectrum;
  static fb_body_desc desc;
  const fbt_table *table = fbt_reference(file);
  fb_modes_desc keep;
  double worst = 0.0, eta = -1.0, radius = -1.0;
  for (int row = 0; row < 2 * table->rows; row++) { /* first all of lag, then of flap */
    const int flap = row >= table->rows, at = row % table->rows, mode = (int)fbt_value(table, at, "mode");
    const double want = fbt_value(table, at, flap ? "mu_flap" : "mu_lag");
    fb_state state;
    fb_input input;
    if (row % table->rows == 0 || fbt_value(table, at, "alpha") != radius) {
      radius = fbt_value(table, at, "alpha");
      eta = -1.0;
      rotor_blade(tapered);
      beam_desc.n_element = 20;
      beam_desc.position[0] = (fb_real)radius;
      memset(&desc, 0, sizeof desc);
      memset(&keep, 0, sizeof keep);
      desc.effects = FB_EFFECTS_FULL;
      desc.base = FB_BASE_PRESCRIBED;
      keep.spin = FB_R(40.0);
      keep.spin_radius = (fb_real)radius;
      keep.count[flap ? FB_KIND_BEND_Z : FB_KIND_BEND_Y] = 20;
      FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
      FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
      FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
      FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
      FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
    }
    if (fbt_value(table, at, "eta") != eta) {
      eta = fbt_value(table, at, "eta");
      memset(&input, 0, sizeof input);
      input.w[2] = (fb_real)eta;
      FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
      FBT_INT_EQ(fb_body_trim(&body, &state, &analyse_work, &input), FB_OK);
      FBT_INT_EQ(fb_body_spectrum_solve(&body, &analyse_work, &spectrum, &state, &input), FB_OK);
    }
    if (want > 0.0) { /* the mode's own number: of one plane there are no others */
      worst = fmax(worst, fabs((double)spectrum.im[mode - 1] / want - 1.0));
      FBT_NEAR_ABS(spectrum.re[mode - 1], 0.0, FBT_TOL(1e-9, 1e-3) * want);
    }
  }
  return worst;
}

/* E12.2, E12.3: eigenvalues of rotating cantilevers about their steady spin (tests/reference/p02), to 1e-6. */
TEST(linear_models_of_spinning_beams_have_the_published_frequencies)
{
  const double uniform = linear_spinning_error("p02_rotating_uniform.csv", 0);
  const double tapered = FBT_SHORT ? uniform : linear_spinning_error("p02_rotating_tapered.csv", 1);
  fbt_figure("eigenvalues of a rotating cantilever, four of flap and lag, eta 0..50", "power series (p02)", uniform);
  fbt_figure("the same of a tapered one", "power series (p02)", tapered);
  FBT_BELOW(uniform, FBT_TOL(1e-6, 5e-2));
  FBT_BELOW(tapered, FBT_TOL(1e-6, 5e-2));
}

/* E8.13, E8.18 with n = 0: a rigid body is a case of the same code; a free asymmetric top against Jacobi elliptic
   functions. */
TEST(a_rigid_body_is_the_case_of_no_modes)
{
  const fbt_table *table = fbt_reference("p10_asymmetric_top.csv");
  static fb_body_desc desc;
  static const fb_real center[3] = {0}, inertia[6] = {1, 2, 3, 0, 0, 0};
  static const fb_real v[3] = {0}, w[3] = {FB_R(0.1), FB_R(5.0), FB_R(0.1)};
  fb_state state;
  fb_rk4_work work;
  fb_motion motion;
  double error = 0.0;
  memset(&desc, 0, sizeof desc);
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(1.0), center, inertia), FB_OK);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, w, NULL), FB_OK);
  for (int k = 1; k <= FBT_TOL(10, 3); k++) { /* one row a second */
    for (int i = 0; i < 4000; i++) {
      FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, FB_R(0.00025)), FB_OK);
    }
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, NULL), FB_OK);
    error = fmax(error, fabs((double)motion.w[0] - fbt_value(table, k, "w1")));
    error = fmax(error, fabs((double)motion.w[1] - fbt_value(table, k, "w2")));
    error = fmax(error, fabs((double)motion.w[2] - fbt_value(table, k, "w3")));
    error = fmax(error, fabs((double)state.quat[1] * fbt_value(table, k, "q0") -
                             (double)state.quat[0] * fbt_value(table, k, "q1")));
  }
  fbt_figure("free asymmetric top", "Jacobi elliptic functions (p10)", error);
  FBT_BELOW(error, FBT_TOL(1e-8, 1e-2)); /* the motion passes its separatrix: errors grow e-fold by e-fold */
}

SUITE(body_motion, RUN(potential_energies_agree_with_a_particle_model), RUN(damping_is_that_of_a_particle_on_a_spring),
      RUN(nodes_are_those_of_the_shape), RUN(nodes_that_turn_far_have_the_rates_of_their_pose),
      RUN(power_of_loads_is_the_rate_of_energy), RUN(node_kinematics_match_finite_differences),
      RUN(reactions_balance_the_momentum), RUN(a_held_body_is_a_free_one_with_its_reactions),
      RUN(pinned_and_hinged_bodies_swing_as_rigid_pendulums), RUN(a_falling_body_does_not_deform),
      RUN(elastic_response_is_frame_indifferent), RUN(damped_free_decay_has_the_given_ratio),
      RUN(spinning_beams_stiffen_as_published), RUN(linear_models_of_spinning_beams_have_the_published_frequencies),
      RUN(a_rigid_body_is_the_case_of_no_modes))
