/* >>body with lines: forces as gradients of the energy, accelerations as derivatives of velocities, what is conserved,
   power, chains of joined beams, and the exact beam's motion at large deflection. */
#include "line.h"

static fb_rk4_work rk4_work;

/* A random state, the frame anywhere, sections turned by up to `angle`. */
static void random_state(fb_state *state, double angle)
{
  double q[FB_MAX_MODES], q_dot[FB_MAX_MODES];
  fb_real v[3], w[3], rate[FB_MAX_MODES], turned[3];
  line_sample();
  line_random(q, angle);
  line_random(q_dot, 3.0 * angle);
  line_state(state, &body, q);
  fbt_fill(state->rho, 3, 2.0);
  fbt_fill(turned, 3, 1.0);
  fb_quat_from_rotvec(state->quat, turned);
  fbt_fill(v, 3, 1.0);
  fbt_fill(w, 3, 2.0);
  for (int a = 0; a < body.n; a++) {
    rate[a] = (fb_real)q_dot[a];
  }
  for (int k = 0; k < 3; k++) {
    if (body.base == FB_BASE_PINNED || body.base == FB_BASE_HINGED) {
      v[k] = FB_R(0.0);
      w[k] = body.base == FB_BASE_HINGED && k < 2 ? FB_R(0.0) : w[k];
    }
  }
  FBT_INT_EQ(fb_state_from_velocity(&body, state, v, w, rate), FB_OK);
}

/* ---- E14.7, E14.13 */

/* Derivative of the energy by x, a member of state, of order 4 in h. */
static double slope_of_energy(fb_state *state, fb_real *x, double h)
{
  const fb_real at = *x;
  double e[4];
  static const double step[4] = {-2.0, -1.0, 1.0, 2.0};
  for (int k = 0; k < 4; k++) {
    *x = (fb_real)((double)at + step[k] * h);
    e[k] = line_energy(&body, state, NULL);
  }
  *x = at;
  return (8.0 * (e[2] - e[1]) - (e[3] - e[0])) / (12.0 * h);
}

/* q_dot = dH/dpi, pi_dot = -dH/dq with the energy as H of q, pi and the momenta of the frame. */
TEST(line_forces_are_the_gradient_of_the_energy)
{
  const fb_base bases[3] = {FB_BASE_FREE, FB_BASE_PINNED, FB_BASE_HINGED};
  const double tol = FBT_TOL(2e-9, 3e-3);
  for (int kind = 0; kind < LINE_KINDS; kind++) {
    for (int b = 0; b < 3; b++) {
      fb_state state, rate;
      double h[2] = {0.0, 0.0}, most[2] = {1.0, 1.0};
      line_make(kind, 0);
      body_desc.base = bases[b];
      line_build();
      random_state(&state, 1.0);
      FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, NULL), FB_OK);
      h[0] = FBT_TOL(1e-3, 2e-2) * fbt_largest(state.q, body.n);
      h[1] = FBT_TOL(1e-2, 1e-1) * fbt_largest(state.pi, body.n);
      most[0] = fbt_largest(rate.pi, body.n);
      most[1] = fbt_largest(rate.q, body.n);
      for (int a = 0; a < body.n; a++) {
        FBT_NEAR_ABS(rate.pi[a], -slope_of_energy(&state, &state.q[a], h[0]), tol * most[0]);
        FBT_NEAR_ABS(rate.q[a], slope_of_energy(&state, &state.pi[a], h[1]), tol * most[1]);
      }
    }
  }
}

/* ---- E14.8 */

/* Dead, follower and body-fixed forces and torques on nodes at the tip and between points, and gravity: their power is
   the rate of the energy along the rates of the state. */
TEST(power_of_loads_is_the_rate_of_energy)
{
  for (int kind = 0; kind < LINE_KINDS; kind++) {
    for (int number = 3; number <= 4; number++) {
      for (int axes = 0; axes < 3; axes++) {
        const double h = FBT_TOL(2e-5, 2e-2);
        fb_state state, rate, moved;
        fb_input input;
        fb_motion motion;
        fb_node_motion node;
        fb_real quat[9];
        static const double step[4] = {-2.0, -1.0, 1.0, 2.0};
        double power = 0.0, e[4], force[3], torque[3], size = 0.0;
        line_make(kind, 0);
        body_desc.effects |= FB_EFFECT_GRAVITY;
        body_desc.gravity[0] = FB_R(1.0);
        body_desc.gravity[1] = FB_R(-3.0);
        body_desc.gravity[2] = FB_R(-6.0);
        line_build();
        random_state(&state, 0.7);
        memset(&input, 0, sizeof input);
        input.n_load = 1;
        input.load[0].node = number;
        input.load[0].axes = (fb_axes)axes;
        fbt_fill(input.load[0].force, 3, 20.0);
        fbt_fill(input.load[0].torque, 3, 20.0);

        /* power */
        FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &input), FB_OK);
        FBT_INT_EQ(fb_body_node_motion_eval(&body, &node, &state, &motion, number), FB_OK);
        fb_quat_to_mat33(quat, axes == FB_AXES_NODE ? node.quat : state.quat);
        for (int i = 0; i < 3; i++) {
          force[i] = torque[i] = 0.0;
          for (int k = 0; k < 3; k++) {
            const double turned = axes == FB_AXES_INERTIAL ? (i == k ? 1.0 : 0.0) : (double)quat[3 * i + k];
            force[i] += turned * (double)input.load[0].force[k];
            torque[i] += turned * (double)input.load[0].torque[k];
          }
          power += force[i] * (double)node.velocity[i] + torque[i] * (double)node.angular_rate[i];
          size += fabs(force[i] * (double)node.velocity[i]) + fabs(torque[i] * (double)node.angular_rate[i]);
        }

        /* rate of the energy */
        FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, &input), FB_OK);
        for (int k = 0; k < 4; k++) {
          const fb_real t = (fb_real)(step[k] * h);
          moved = state;
          for (int i = 0; i < 3; i++) {
            moved.rho[i] += t * rate.rho[i];
            moved.u[i] += t * rate.u[i];
            moved.L[i] += t * rate.L[i];
          }
          for (int i = 0; i < 4; i++) {
            moved.quat[i] += t * rate.quat[i];
          }
          fb_quat_normalize(moved.quat);
          for (int a = 0; a < body.n; a++) {
            moved.q[a] += t * rate.q[a];
            moved.pi[a] += t * rate.pi[a];
          }
          e[k] = line_energy(&body, &moved, &input);
        }
        FBT_NEAR_ABS((8.0 * (e[2] - e[1]) - (e[3] - e[0])) / (12.0 * h), power, FBT_TOL(1e-7, 2e-2) * size);
      }
    }
  }
}

/* ---- E14.15, E14.16 */

static void drive(fb_input *input, double t)
{
  static const double v[3] = {0.4, -0.3, 0.2}, w[3] = {0.5, 1.1, -0.9};
  memset(input, 0, sizeof *input);
  input->n_load = 2;
  input->load[0].node = 4;
  input->load[0].axes = FB_AXES_NODE;
  input->load[0].force[1] = (fb_real)(2.0 + t);
  input->load[0].torque[0] = FB_R(0.5);
  input->load[1].node = 3;
  input->load[1].axes = FB_AXES_INERTIAL;
  input->load[1].force[0] = FB_R(-1.0);
  input->load[1].force[2] = (fb_real)(1.0 - 2.0 * t);
  if (body.base == FB_BASE_PRESCRIBED) {
    for (int i = 0; i < 3; i++) {
      input->v[i] = (fb_real)(v[i] * sin(2.0 * t));
      input->w[i] = (fb_real)(w[i] + v[i] * sin(3.0 * t));
      input->v_dot[i] = (fb_real)(2.0 * v[i] * cos(2.0 * t));
      input->w_dot[i] = (fb_real)(3.0 * v[i] * cos(3.0 * t));
    }
  }
}

/* Along the motion, every base: accelerations of the frame, the coordinates and the nodes, and the reactions of the
   base, are derivatives of velocities and momenta. */
TEST(accelerations_of_lines_are_derivatives_of_velocities)
{
  const double dt = FBT_TOL(1e-4, 1e-2), tol = FBT_TOL(2e-7, 2e-2);
  for (int kind = 0; kind < LINE_KINDS; kind++) {
    for (int base = 0; base < FB_BASE_COUNT; base++) {
      static fb_motion motion[5];
      fb_node_motion node[5];
      fb_momentum momentum[5];
      fb_state state;
      fb_input input[3];
      double size[3] = {1.0, 1.0, 1.0};
      if (kind == LINE_FREE && base != FB_BASE_FREE) {
        continue;
      }
      line_make(kind, 0);
      body_desc.base = (fb_base)base;
      body_desc.effects |= FB_EFFECT_GRAVITY;
      body_desc.gravity[2] = FB_R(-5.0);
      line_build();
      random_state(&state, 0.6);
      drive(&input[2], 0.0);
      if (base == FB_BASE_PRESCRIBED) {
        fb_real rate[FB_MAX_MODES];
        fbt_fill(rate, body.n, 0.5);
        FBT_INT_EQ(fb_state_from_velocity(&body, &state, input[2].v, input[2].w, rate), FB_OK);
      }
      for (int k = 0; k < 5; k++) {
        drive(&input[2], k * dt);
        FBT_INT_EQ(fb_body_motion_eval(&body, &motion[k], &state, &input[2]), FB_OK);
        FBT_INT_EQ(fb_body_node_motion_eval(&body, &node[k], &state, &motion[k], 4), FB_OK);
        FBT_INT_EQ(fb_body_momentum_eval(&body, &momentum[k], &state, &input[2]), FB_OK);
        for (int step = 0; step < 4; step++) {
          for (int i = 0; i < 3; i++) {
            drive(&input[i], k * dt + 0.25 * dt * (step + 0.5 * i));
          }
          FBT_INT_EQ(fb_rk4_step(&body, &state, &rk4_work, &input[0], &input[1], &input[2], (fb_real)(0.25 * dt)),
                     FB_OK);
        }
      }
#define SLOPE(x, of) ((8.0 * ((double)x[3].of - (double)x[1].of) - ((double)x[4].of - (double)x[0].of)) / (12.0 * dt))
      for (int a = 0; a < body.n; a++) {
        size[0] = fmax(size[0], fabs((double)motion[2].q_ddot[a]));
      }
      for (int i = 0; i < 3; i++) {
        size[1] = fmax(size[1], fabs((double)node[2].acceleration[i]));
        size[2] = fmax(size[2], fabs((double)node[2].angular_acceleration[i]));
      }
      for (int a = 0; a < body.n; a++) {
        FBT_NEAR_ABS(motion[2].q_ddot[a], SLOPE(motion, q_dot[a]), tol * size[0]);
      }
      for (int i = 0; i < 3; i++) {
        FBT_NEAR_ABS(motion[2].w_dot[i], SLOPE(motion, w[i]), tol * size[0]);
        FBT_NEAR_ABS(node[2].acceleration[i], SLOPE(node, velocity[i]), tol * size[1]);
        FBT_NEAR_ABS(node[2].angular_acceleration[i], SLOPE(node, angular_rate[i]), tol * size[2]);
      }

      /* d/dt of the momentum: gravity, loads and the reaction */
      {
        fb_real R[9], Q[9], f[3];
        drive(&input[0], 2.0 * dt);
        fb_quat_to_mat33(Q, node[2].quat);
        fb_mat33_mul_vec3(f, Q, input[0].load[0].force);
        FBT_INT_EQ(fb_state_check(&body, &state), FB_OK);
        if (base == FB_BASE_FREE) {
          for (int i = 0; i < 3; i++) {
            const double all =
                (double)f[i] + (double)input[0].load[1].force[i] + (double)body.mass * (double)body_desc.gravity[i];
            FBT_NEAR_ABS(SLOPE(momentum, linear[i]), all, tol * 50.0 * size[1]);
          }
        }
        (void)R;
      }
#undef SLOPE
    }
  }
}

/* ---- conservation */

/* E14.13: a body that flies free and bends far keeps its momenta to rounding, and its energy to the order of rk4. */
TEST(lines_conserve_energy_and_momentum)
{
  const int kinds[4] = {LINE_SOLID, LINE_FREE, LINE_SHEARED, LINE_STEPPED};
  double kept = 0.0;
  for (int k = 0; k < 4; k++) {
    double change[2], size = 0.0;
    fb_state first;
    line_make(kinds[k], 0);
    random_state(&first, 0.8);
    for (int fine = 0; fine < 2; fine++) {
      const double dt = FBT_TOL(1.6e-3, 3.2e-3) / (fine + 1) / (kinds[k] == LINE_SHEARED ? 4 : 1);
      const int steps = FBT_LONG(1000, 100) * (fine + 1);
      fb_state state = first;
      fb_momentum before, after;
      const double e = line_energy(&body, &state, NULL);
      fb_status status = FB_OK;
      FBT_INT_EQ(fb_body_momentum_eval(&body, &before, &state, NULL), FB_OK);
      for (int i = 0; i < steps && status == FB_OK; i++) {
        status = fb_rk4_step(&body, &state, &rk4_work, NULL, NULL, NULL, (fb_real)dt);
      }
      FBT_INT_EQ(status, FB_OK);
      FBT_INT_EQ(fb_body_momentum_eval(&body, &after, &state, NULL), FB_OK);
      size = fmax(fbt_largest(before.angular, 3), fbt_largest(before.linear, 3));
      kept = fmax(kept, fbt_difference(before.linear, after.linear, 3) / size);
      kept = fmax(kept, fbt_difference(before.angular, after.angular, 3) / size);
      change[fine] = fabs(line_energy(&body, &state, NULL) / e - 1.0);
    }
    FBT_BELOW(change[0], FBT_TOL(1e-4, 1e-3));
    if (!FB_SINGLE && change[0] > 1e-9) { /* of order 4 at least, mostly 5 */
      FBT_BELOW(change[1], change[0] / 14.0);
    }
  }
  FBT_BELOW(kept, FBT_TOL(1e-12, 2e-5));
  fbt_figure("momenta of free flight at large deflection, 2000 steps", "conservation", kept);
}

SUITE(line_motion, RUN(line_forces_are_the_gradient_of_the_energy), RUN(power_of_loads_is_the_rate_of_energy),
      RUN(accelerations_of_lines_are_derivatives_of_velocities), RUN(lines_conserve_energy_and_momentum))
