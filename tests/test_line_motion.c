/* >>body with lines: forces as gradients of the energy, accelerations as derivatives of velocities, what is conserved,
   power, chains of joined beams, and the exact beam's motion at large deflection. */
#include "line.h"

static fb_rk4_work rk4_work;
static const double pi = 3.14159265358979323846;

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

/* E14.7, E14.13: q_dot = dH/dpi, pi_dot = -dH/dq with the energy as H of q, pi and the momenta of the frame. */
TEST(line_forces_are_the_gradient_of_the_energy)
{
  const fb_base bases[3] = {FB_BASE_FREE, FB_BASE_PINNED, FB_BASE_HINGED};
  const double tol = FBT_TOL(2e-9, 3e-3);
  for (int kind = 0; kind < LINE_KINDS; kind++) {
    for (int b = FBT_LONG(0, kind % 3); b < 3; b += FBT_LONG(1, 3)) {
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

/* E14.8, E8.15, E8.16, E8.33: dead, follower and body-fixed forces and torques on nodes at the tip and between points,
   and gravity: their power is the rate of the energy along the rates of the state. */
TEST(power_of_loads_is_the_rate_of_energy)
{
  for (int kind = 0; kind < LINE_KINDS; kind++) {
    for (int number = FBT_LONG(3, 4); number <= 4; number++) {
      for (int axes = FBT_LONG(0, kind % 3); axes < 3; axes += FBT_LONG(1, 3)) {
        const double h = FBT_TOL(2e-5, 2e-3);
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

/* E14.9, E14.15, E14.16: along the motion, every base: accelerations of the frame, the coordinates and the nodes are
   derivatives of velocities; loads and gravity are the rate of the momentum. */
TEST(accelerations_of_lines_are_derivatives_of_velocities)
{
  const double dt = FBT_TOL(1e-4, 2e-3), tol = FBT_TOL(2e-7, 4e-2);
  for (int kind = 0; kind < LINE_KINDS; kind++) {
    for (int base = 0; base < FB_BASE_COUNT; base++) {
      static fb_motion motion[5];
      fb_node_motion node[5];
      fb_momentum momentum[5];
      fb_state state;
      fb_input input[3];
      double size[3] = {1.0, 1.0, 1.0};
      if ((kind == LINE_FREE && base != FB_BASE_FREE) || (FBT_SHORT && (kind + base) % 2)) {
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
#define SLOPE(x, of) \
  ((8.0 * ((double)(x)[3].of - (double)(x)[1].of) - ((double)(x)[4].of - (double)(x)[0].of)) / (12.0 * dt))
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

      /* of a free body: d/dt of the momentum */
      if (base == FB_BASE_FREE) {
        fb_real Q[9], f[3];
        drive(&input[0], 2.0 * dt);
        fb_quat_to_mat33(Q, node[2].quat);
        fb_mat33_mul_vec3(f, Q, input[0].load[0].force);
        for (int i = 0; i < 3; i++) {
          const double all =
              (double)f[i] + (double)input[0].load[1].force[i] + (double)body.mass * (double)body_desc.gravity[i];
          FBT_NEAR_ABS(SLOPE(momentum, linear[i]), all, tol * 50.0 * size[1]);
        }
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
      double largest = 0.0;
      fb_status status = FB_OK;
      FBT_INT_EQ(fb_body_momentum_eval(&body, &before, &state, NULL), FB_OK);
      for (int i = 0; i < steps && status == FB_OK; i++) {
        status = fb_rk4_step(&body, &state, &rk4_work, NULL, NULL, NULL, (fb_real)dt);
        largest = fmax(largest, fabs(line_energy(&body, &state, NULL) / e - 1.0));
      }
      FBT_INT_EQ(status, FB_OK);
      FBT_INT_EQ(fb_body_momentum_eval(&body, &after, &state, NULL), FB_OK);
      size = fmax(fbt_largest(before.angular, 3), fbt_largest(before.linear, 3));
      kept = fmax(kept, fbt_difference(before.linear, after.linear, 3) / size);
      kept = fmax(kept, fbt_difference(before.angular, after.angular, 3) / size);
      change[fine] = largest;
    }
    FBT_BELOW(change[0], FBT_TOL(1e-4, 1e-3));
    if (!FB_SINGLE && change[0] > 1e-9) { /* of order 4 at least, mostly 5 */
      FBT_BELOW(change[1], change[0] / 14.0);
    }
  }
  FBT_BELOW(kept, FBT_TOL(1e-12, 2e-5));
  fbt_figure("momenta of free flight at large deflection, 2000 steps", "conservation", kept);
}

/* ---- large motions of the exact beam, p12_*.csv */

typedef struct line_scene {
  const char *file;
  double mass, EI_y, EI_z, rotary[2], length, payload, gravity[3], spin[3], duration, size, period;
  fb_root root;
  fb_base base;
  int chord, y, z; /* output: the middle against the line between the ends; planes */
  int loaded;      /* load modes at the tip: 2 along z, 3 along y and z */
  int steps;       /* between samples */
} line_scene;

enum { SPINUP, ROTOR, ARM, PENDULUM, RESONANCE, WHIRL, TUMBLING, SAG, SCENES };

static const line_scene scenes[SCENES] = {
    {"p12_spinup_10.csv",
     1.2,
     14004.0,
     14004.0,
     {0.0, 0.0},
     10.0,
     0.0,
     {0.0, 0.0, 0.0},
     {0.0, 0.0, 0.0},
     20.0,
     6.0,
     8.5,
     FB_ROOT_CLAMPED,
     FB_BASE_PRESCRIBED,
     0,
     1,
     0,
     0,
     48},
    {"p12_rotor_10.csv",
     1.0,
     4000.0,
     40000.0,
     {0.0, 0.0},
     5.0,
     0.0,
     {0.0, 0.0, 0.0},
     {0.0, 0.0, 20.0},
     1.5,
     100.0,
     0.3141592653589793,
     FB_ROOT_CLAMPED,
     FB_BASE_PRESCRIBED,
     0,
     1,
     1,
     2,
     24},
    {"p12_arm_10.csv",
     1.5,
     700.0,
     700.0,
     {0.0, 0.0},
     1.2,
     4.0,
     {0.0, -9.81, 0.0},
     {0.0, 0.0, 0.0},
     2.0,
     1.5707963267948966,
     1.0,
     FB_ROOT_CLAMPED,
     FB_BASE_PRESCRIBED,
     0,
     1,
     0,
     0,
     80},
    {"p12_pendulum_2.csv",
     0.5,
     2.0,
     2.0,
     {0.0, 0.0},
     1.0,
     0.0,
     {0.0, -9.81, 0.0},
     {0.0, 0.0, 0.0},
     2.0,
     0.0,
     0.0,
     FB_ROOT_PINNED,
     FB_BASE_HINGED,
     1,
     1,
     0,
     0,
     48},
    {"p12_resonance_20.csv",
     0.3,
     20.0,
     20.0,
     {0.0, 0.0},
     1.5,
     0.0,
     {0.0, 0.0, 0.0},
     {0.0, 0.0, 0.0},
     4.0,
     1.5,
     12.0,
     FB_ROOT_CLAMPED,
     FB_BASE_PRESCRIBED,
     0,
     0,
     1,
     0,
     48},
    {"p12_whirl_20.csv",
     0.3,
     20.0,
     40.0,
     {0.0, 0.0},
     1.5,
     0.0,
     {0.0, 0.0, 0.0},
     {0.0, 0.0, 0.0},
     3.0,
     2.4,
     12.0,
     FB_ROOT_CLAMPED,
     FB_BASE_PRESCRIBED,
     0,
     1,
     1,
     0,
     48},
    {"p12_tumbling_3.csv",
     1.0,
     20.0,
     30.0,
     {0.04, 0.06},
     3.0,
     0.0,
     {0.0, 0.0, 0.0},
     {1.0, 2.0, 3.0},
     5.0,
     5.0,
     0.5,
     FB_ROOT_FREE,
     FB_BASE_FREE,
     1,
     1,
     1,
     3,
     16},
    {"p12_sag_20.csv",
     0.4,
     40.0,
     40.0,
     {0.0, 0.0},
     2.0,
     0.0,
     {0.0, 0.0, -9.81},
     {0.0, 0.0, 0.0},
     4.0,
     0.0,
     0.0,
     FB_ROOT_CLAMPED,
     FB_BASE_PRESCRIBED,
     0,
     0,
     1,
     0,
     48},
};

/* Velocity of the base and load at time t: those of bench/case.h; of resonance and whirl the base swings with `period`
   rad/s and `size` m/s^2, which rise within a second. */
static void scene_drive(fb_input *in, int k, double t)
{
  const line_scene *const c = &scenes[k];
  memset(in, 0, sizeof *in);
  switch (k) {
  case SPINUP: {
    const double phase = 2.0 * pi * t / c->period;
    in->w[2] = (fb_real)(t < c->period ? c->size / c->period * (t - c->period / (2.0 * pi) * sin(phase)) : c->size);
    in->w_dot[2] = (fb_real)(t < c->period ? c->size / c->period * (1.0 - cos(phase)) : 0.0);
    break;
  }
  case ROTOR:
    in->w[2] = (fb_real)c->spin[2];
    in->n_load = 1;
    in->load[0].node = 3;
    in->load[0].axes = FB_AXES_BODY;
    in->load[0].force[2] = (fb_real)(0.5 * c->size * (1.0 - cos(2.0 * pi * t / c->period)));
    break;
  case ARM: {
    const double s = t < c->period ? t / c->period : 1.0;
    in->w[2] = (fb_real)(c->size / c->period * 30.0 * s * s * (1.0 - s) * (1.0 - s));
    in->w_dot[2] = (fb_real)(c->size / (c->period * c->period) * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s));
    break;
  }
  case RESONANCE:
  case WHIRL: {
    const double omega = c->period, rise = 1.0, s = t < rise ? t / rise : 1.0, V = c->size / omega;
    const double ramp = s * s * (3.0 - 2.0 * s), rate = t < rise ? 6.0 * s * (1.0 - s) / rise : 0.0;
    const int axis = k == WHIRL ? 1 : 2;
    in->v[axis] = (fb_real)(V * ramp * sin(omega * t));
    in->v_dot[axis] = (fb_real)(V * (rate * sin(omega * t) + ramp * omega * cos(omega * t)));
    if (k == WHIRL) {
      in->v[2] = (fb_real)(V * ramp * cos(omega * t));
      in->v_dot[2] = (fb_real)(V * (rate * cos(omega * t) - ramp * omega * sin(omega * t)));
    }
    break;
  }
  case TUMBLING:
    in->n_load = 1;
    in->load[0].node = 3;
    in->load[0].axes = FB_AXES_INERTIAL;
    in->load[0].force[1] = (fb_real)(t < c->period ? c->size * sin(pi * t / c->period) * sin(pi * t / c->period) : 0.0);
    in->load[0].force[2] = FB_R(0.5) * in->load[0].force[1];
    break;
  default:
    break;
  }
}

/* The body of a scene with n modes a plane, load modes beside them where loads act. */
static void scene_build(int k, int n)
{
  const line_scene *const c = &scenes[k];
  line_beam(c->length, c->mass, c->EI_y, c->EI_z, 8);
  line_solid(c->rotary[0], c->rotary[1], 0.0);
  line_count(c->y ? n : 0, c->z ? n : 0, 0, 0);
  hub_mass = 0.0;
  beam_desc.root = c->root;
  body_desc.base = c->base;
  if (c->root == FB_ROOT_FREE) {
    beam_desc.position[0] = (fb_real)(-0.5 * c->length);
  }
  if (c->payload > 0.0) {
    beam_desc.n_lump = 1;
    beam_desc.lump[0].node = 8;
    beam_desc.lump[0].mass = (fb_real)c->payload;
    beam_desc.lump[0].inertia[0] = beam_desc.lump[0].inertia[1] = beam_desc.lump[0].inertia[2] = FB_R(0.01);
  }
  if (k == ROTOR) {
    keep.spin = (fb_real)c->spin[2];
  }
  for (int axis = 1; axis < 3; axis++) {
    if (c->loaded & axis) {
      line_load_mode(8, axis);
    }
  }
  if (c->gravity[1] != 0.0 || c->gravity[2] != 0.0) {
    body_desc.effects |= FB_EFFECT_GRAVITY;
    for (int i = 0; i < 3; i++) {
      body_desc.gravity[i] = (fb_real)c->gravity[i];
    }
  }
  line_build();
}

/* Largest error by the largest value. */
static double scene_error(int k, int n, int steps)
{
  static fb_analyse_work analyse_work;
  const line_scene *const c = &scenes[k];
  const fbt_table *table = fbt_reference(c->file);
  const double dt = c->duration / (160.0 * steps);
  const fb_real still[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)};
  const fb_real spin[3] = {(fb_real)c->spin[0], (fb_real)c->spin[1], (fb_real)c->spin[2]};
  double most = 0.0, size = 0.0;
  fb_state state;
  fb_input in[3];
  fb_status status;
  scene_build(k, n);
  scene_drive(&in[2], k, 0.0);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  status = k == ROTOR ? fb_body_trim(&body, &state, &analyse_work, &in[2])
                      : fb_state_from_velocity(&body, &state, in[2].v, c->base == FB_BASE_FREE ? spin : still, NULL);
  FBT_INT_EQ(status, FB_OK);
  for (int row = 0; row < table->rows && status == FB_OK; row++) {
    fb_node_motion node[3];
    fb_real R[9], d[3], y[3];
    double e = 0.0, s = 0.0;
    for (int i = 0; i < steps && status == FB_OK; i++) {
      in[0] = in[2];
      scene_drive(&in[1], k, (row * steps + i + 0.5) * dt);
      scene_drive(&in[2], k, (row * steps + i + 1) * dt);
      status = fb_rk4_step(&body, &state, &rk4_work, &in[0], &in[1], &in[2], (fb_real)dt);
    }
    for (int i = 0; i < 3; i++) {
      line_node(&node[i], &body, &state, i + 1);
    }
    fb_quat_to_mat33(R, node[c->chord].quat);
    for (int i = 0; i < 3; i++) {
      d[i] = c->chord ? node[1].position[i] - FB_R(0.5) * (node[0].position[i] + node[2].position[i])
                      : node[2].position[i] - node[0].position[i];
    }
    fb_mat33_mulT_vec3(y, R, d);
    y[0] -= c->chord ? FB_R(0.0) : (fb_real)c->length;
    for (int i = 0; i < 3; i++) {
      const double x = fbt_value(table, row, i == 0 ? "x" : i == 1 ? "y" : "z");
      e += ((double)y[i] - x) * ((double)y[i] - x);
      s += x * x;
    }
    most = fmax(most, e);
    size = fmax(size, s);
  }
  FBT_INT_EQ(status, FB_OK);
  return sqrt(most / size);
}

/* E14.1, E14.13: eight motions of 2 to 20 % of the length: 0.1 % with four modes a plane, 0.01 % with six (tumbling 0.1
   %), natural modes, of the rotor at its spin, and a load mode for each direction in which the tip is loaded. */
TEST(lines_move_as_the_exact_beam)
{
  for (int k = 0; k < SCENES; k += FBT_LONG(1, 2)) {
    const double four = scene_error(k, 4, scenes[k].steps);
    FBT_BELOW(four, FBT_TOL(1e-3, 1e-2));
    fbt_figure("large motion of the exact beam, 4 modes a plane", scenes[k].file, four);
    if (!FB_SINGLE && !FBT_SHORT) {
      const double six = scene_error(k, 6, scenes[k].steps);
      FBT_BELOW(six, k == TUMBLING ? 1e-3 : 1e-4);
      fbt_figure("large motion of the exact beam, 6 modes a plane", scenes[k].file, six);
    }
  }
}

/* ---- bending in both planes with twist */

/* Force along y and z and torque about x at the tip at time t, body axes, without end: on, off, on again. */
static void twist_load(fb_load *load, int node, double t)
{
  const fb_real s = (fb_real)(sin(pi * t) * sin(pi * t));
  memset(load, 0, sizeof *load);
  load->node = node;
  load->axes = FB_AXES_BODY;
  load->force[1] = FB_R(15.0) * s;
  load->force[2] = FB_R(9.0) * s;
  load->torque[0] = FB_R(1.5) * s;
}

enum { TWIST_SAMPLES = 40 }; /* of 0.0375 s */

/* Positions of the exact beam's tip, `steps` steps a sample. */
static void twist_exact(double tip[TWIST_SAMPLES][3], int n_element, int steps)
{
  static fb_exact_desc desc;
  static fb_exact exact;
  static fb_exact_state state;
  static fb_exact_work work;
  static fb_exact_input input;
  static fb_exact_node node[FB_MAX_EXACT + 1];
  const double dt = 0.0375 / steps;
  fb_status status;
  memset(&desc, 0, sizeof desc);
  memset(&input, 0, sizeof input);
  desc.length = beam_desc.length;
  desc.n_element = n_element;
  desc.n_station = 1;
  desc.root = FB_END_CLAMPED;
  FBT_INT_EQ(fb_exact_station_init(&desc.station[0], &beam_desc.station[0]), FB_OK);
  FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_OK);
  FBT_INT_EQ(fb_exact_state_init(&exact, &state, &work, &input), FB_OK);
  input.n_load = 1;
  status = FB_OK;
  for (int k = 0; k < TWIST_SAMPLES; k++) {
    for (int i = 0; i < steps && status == FB_OK; i++) {
      twist_load(&input.load[0], n_element, (k * steps + i + 0.5) * dt);
      status = fb_exact_step(&exact, &state, &work, &input, (fb_real)dt);
    }
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    for (int i = 0; i < 3; i++) {
      tip[k][i] = (double)node[n_element].position[i];
    }
  }
  FBT_INT_EQ(status, FB_OK);
}

/* E14.1, E14.13: a beam half as stiff in torsion as in bending is pushed in both planes, by 54 % of its length, and
   twisted: it moves as the exact beam of 24 elements, extrapolated in the step. */
TEST(lines_that_twist_move_as_the_exact_beam)
{
  static double tip[2][TWIST_SAMPLES][3];
  const int steps = 40;
  const double dt = 0.0375 / steps;
  double most = 0.0, size = 0.0;
  fb_input in[3];
  fb_state state;
  fb_status status = FB_OK;
  line_beam(2.0, 0.4, 40.0, 60.0, 8);
  line_solid(0.001, 0.001, 20.0);
  line_count(3, 3, 0, 3);
  line_load_mode(8, 1);
  line_load_mode(8, 2);
  line_load_mode(8, 3);
  body_desc.base = FB_BASE_PRESCRIBED;
  line_build();
  twist_exact(tip[0], 24, FBT_TOL(12, 3));
  twist_exact(tip[1], 24, FBT_TOL(24, 6));
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  memset(in, 0, sizeof in);
  in[0].n_load = in[1].n_load = in[2].n_load = 1;
  for (int k = 0; k < TWIST_SAMPLES && status == FB_OK; k++) {
    fb_node_motion node;
    double e = 0.0, s = 0.0;
    for (int i = 0; i < steps && status == FB_OK; i++) {
      for (int stage = 0; stage < 3; stage++) {
        twist_load(&in[stage].load[0], 3, (k * steps + i + 0.5 * stage) * dt);
      }
      status = fb_rk4_step(&body, &state, &rk4_work, &in[0], &in[1], &in[2], (fb_real)dt);
    }
    line_node(&node, &body, &state, 3);
    for (int i = 0; i < 3; i++) {
      const double x = tip[1][k][i] + (tip[1][k][i] - tip[0][k][i]) / 3.0, u = x - (i == 0 ? 2.0 : 0.0);
      e += ((double)node.position[i] - x) * ((double)node.position[i] - x);
      s += u * u;
    }
    most = fmax(most, e);
    size = fmax(size, s);
  }
  FBT_INT_EQ(status, FB_OK);
  FBT_BELOW(0.5, sqrt(size) / 2.0);
  FBT_BELOW(sqrt(most / size), FBT_TOL(1e-3, 1e-2));
  fbt_figure("bending by 54 % in both planes with twist, 4 + 4 + 4 modes", "exact beam, 24 elements",
             sqrt(most / size));
}

/* ---- chains of joined beams, whose lines hang on each other: E14.5 to E14.9 with their first rotation, E14.13 */

/* A body of 0.3 kg on the tip of a beam, as six particles in pairs about its center, or as one lumped body. */
static void tip_body(fb_beam_desc *beam_of, int particles)
{
  static const double center[3] = {0.03, -0.08, 0.05};
  static const double pair[3][3] = {{0.2, 0.04, 0.0}, {-0.04, 0.1, 0.03}, {0.04, 0.0, 0.3}}; /* half its span [m] */
  fb_real C[9] = {FB_R(0.0)};
  for (int k = 0; k < 6; k++) {
    fb_lump *const lump = &beam_of->lump[particles ? k : 0];
    beam_of->n_lump = particles ? 6 : 1;
    lump->node = 1;
    lump->mass = particles ? FB_R(0.05) : FB_R(0.3);
    for (int i = 0; i < 3; i++) {
      lump->center[i] = (fb_real)(center[i] + (particles ? (k % 2 ? 1.0 : -1.0) * pair[k / 2][i] : 0.0));
      for (int j = 0; j < 3; j++) {
        C[3 * i + j] += (fb_real)(0.05 * pair[k / 2][i] * pair[k / 2][j]);
      }
    }
  }
  if (!particles) { /* J = tr(C) 1 - C */
    fb_real *const J = beam_of->lump[0].inertia;
    J[0] = C[4] + C[8];
    J[1] = C[0] + C[8];
    J[2] = C[0] + C[4];
    J[3] = -C[1];
    J[4] = -C[2];
    J[5] = -C[5];
  }
}

enum { BARE, TIP_BODIES, TIP_PARTICLES };

/* Three beams root to tip, the second at a right angle, the third along the first, on a hub; nodes at the tips, bodies on
   those of the last two. */
static void chain_build(int tips)
{
  static fb_build_work build_work;
  static fb_build_desc desc;
  static fb_modes_desc kept[2];
  static fb_beam_desc beams[2];
  line_beam(1.0, 1.0, 20.0, 30.0, 1);
  line_solid(0.01, 0.02, 25.0);
  line_count(2, 2, 0, 1);
  beam_desc.station[0].mass_y = FB_R(0.03);
  beams[0] = beams[1] = beam_desc;
  beams[1].root = FB_ROOT_FREE;
  if (tips != BARE) {
    tip_body(&beams[1], tips == TIP_PARTICLES);
  }
  kept[0] = kept[1] = keep;
  kept[0].line_points = 9;
  for (int axis = 0; axis < 6; axis++) { /* what the next beam does to a tip */
    kept[0].load[kept[0].n_load].node = 1;
    kept[0].load[kept[0].n_load].axis = axis;
    kept[0].n_load += axis != 0;
  }
  kept[1] = kept[0];
  kept[1].rigid = 1;
  memset(&desc, 0, sizeof desc);
  desc.mass = FB_R(5.0);
  desc.inertia[0] = desc.inertia[1] = desc.inertia[2] = FB_R(2.0);
  desc.n_part = 3;
  for (int k = 0; k < 3; k++) {
    desc.part[k].beam = k > 0;
    desc.part[k].n_node = 1;
    desc.part[k].node[0] = FB_R(1.0);
  }
  desc.part[0].position[0] = FB_R(0.2);
  desc.part[1].position[0] = desc.part[2].position[0] = FB_R(1.2);
  desc.part[1].attitude[0] = desc.part[1].attitude[3] = FB_R(0.70710678118654752); /* along y */
  desc.part[2].position[1] = FB_R(1.0);
  desc.join.n_weld = 2;
  for (int k = 0; k < 2; k++) {
    desc.join.weld[k].component[0] = k;
    desc.join.weld[k].component[1] = k + 1;
    desc.join.weld[k].node[0] = 1;
  }
  desc.join.lowest = 6;
  desc.body = body_desc;
  FBT_INT_EQ(fb_body_build(&body, &build_work, &desc, beams, kept, 2), FB_OK);
  desc.body.effects = FB_EFFECTS_FULL;
  FBT_INT_EQ(fb_body_build(&full, &build_work, &desc, beams, kept, 2), FB_OK);
}

/* Each mode with a random part of `energy` [J], and as much in motion. */
static void chain_state(fb_state *state, double energy, double turning)
{
  fb_real v[3], w[3], rate[FB_MAX_MODES];
  FBT_INT_EQ(fb_state_init(&body, state), FB_OK);
  for (int a = 0; a < body.n; a++) {
    state->q[a] = (fb_real)(sqrt(2.0 * energy / (double)body.K.diagonal[a]) * fbt_random());
    rate[a] = (fb_real)(sqrt(2.0 * energy) * fbt_random());
  }
  fbt_fill(v, 3, turning);
  fbt_fill(w, 3, turning);
  FBT_INT_EQ(fb_state_from_velocity(&body, state, v, w, rate), FB_OK);
}

/* E14.7, E14.16: three lines in a chain: small motions are those of the polynomial body, of large ones the forces are
   the gradient of the energy and the accelerations derivatives along the motion. */
TEST(joined_lines_hang_on_each_other)
{
  fb_state state, rate, other;
  fb_motion motion[2];
  fb_node_motion node[2];
  fb_input in;
  double size = 0.0, h[2];
  chain_build(BARE);
  FBT_INT_EQ(body.lines.n_line, 3);

  /* small: the polynomial body */
  chain_state(&state, FBT_TOL(1e-16, 1e-9), 0.0);
  memset(&in, 0, sizeof in);
  in.n_load = 1;
  in.load[0].node = 3;
  fbt_fill(in.load[0].force, 3, 1.0);
  fbt_fill(in.load[0].torque, 3, 1.0);
  FBT_INT_EQ(fb_body_motion_eval(&body, &motion[0], &state, &in), FB_OK);
  FBT_INT_EQ(fb_body_motion_eval(&full, &motion[1], &state, &in), FB_OK);
  size = fbt_largest(motion[1].q_ddot, body.n);
  FBT_BELOW(fbt_difference(motion[0].q_ddot, motion[1].q_ddot, body.n), FBT_TOL(1e-6, 1e-3) * size);
  FBT_BELOW(fbt_difference(motion[0].acceleration, motion[1].acceleration, 3), FBT_TOL(1e-6, 1e-3) * size);
  FBT_BELOW(fbt_difference(motion[0].w_dot, motion[1].w_dot, 3), FBT_TOL(1e-6, 1e-3) * size);
  for (int k = 1; k <= 3; k++) {
    FBT_INT_EQ(fb_body_node_motion_eval(&body, &node[0], &state, &motion[0], k), FB_OK);
    FBT_INT_EQ(fb_body_node_motion_eval(&full, &node[1], &state, &motion[1], k), FB_OK);
    FBT_BELOW(fbt_difference(node[0].position, node[1].position, 3), FBT_TOL(1e-12, 1e-5));
    FBT_BELOW(fbt_difference(node[0].acceleration, node[1].acceleration, 3), FBT_TOL(1e-6, 1e-3) * size);
  }

  /* large: the gradient of the energy */
  chain_state(&state, 3.0, 1.0);
  FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, NULL), FB_OK);
  h[0] = FBT_TOL(1e-3, 2e-2) * fbt_largest(state.q, body.n);
  h[1] = FBT_TOL(1e-2, 1e-1) * fbt_largest(state.pi, body.n);
  for (int a = 0; a < body.n; a++) {
    FBT_NEAR_ABS(rate.pi[a], -slope_of_energy(&state, &state.q[a], h[0]),
                 FBT_TOL(1e-8, 3e-3) * fbt_largest(rate.pi, body.n));
    FBT_NEAR_ABS(rate.q[a], slope_of_energy(&state, &state.pi[a], h[1]),
                 FBT_TOL(1e-8, 3e-3) * fbt_largest(rate.q, body.n));
  }

  /* large: accelerations by differences along the motion, under loads on the last tip */
  {
    const double dt = FBT_TOL(1e-4, 5e-3);
    static fb_motion at[5];
    fb_node_motion tip[5];
    other = state;
    for (int k = 0; k < 5; k++) {
      FBT_INT_EQ(fb_body_motion_eval(&body, &at[k], &other, &in), FB_OK);
      FBT_INT_EQ(fb_body_node_motion_eval(&body, &tip[k], &other, &at[k], 3), FB_OK);
      for (int i = 0; i < 2; i++) {
        FBT_INT_EQ(fb_rk4_step(&body, &other, &rk4_work, &in, &in, &in, (fb_real)(0.5 * dt)), FB_OK);
      }
    }
#define SLOPE(x, of) \
  ((8.0 * ((double)(x)[3].of - (double)(x)[1].of) - ((double)(x)[4].of - (double)(x)[0].of)) / (12.0 * dt))
    size = fbt_largest(at[2].q_ddot, body.n) + fbt_largest(tip[2].acceleration, 3) +
           fbt_largest(tip[2].angular_acceleration, 3);
    for (int a = 0; a < body.n; a++) {
      FBT_NEAR_ABS(at[2].q_ddot[a], SLOPE(at, q_dot[a]), FBT_TOL(1e-6, 2e-2) * size);
    }
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(at[2].w_dot[i], SLOPE(at, w[i]), FBT_TOL(1e-6, 2e-2) * size);
      FBT_NEAR_ABS(tip[2].velocity[i], SLOPE(tip, position[i]), FBT_TOL(1e-6, 2e-2) * fbt_largest(tip[2].velocity, 3));
      FBT_NEAR_ABS(tip[2].acceleration[i], SLOPE(tip, velocity[i]), FBT_TOL(1e-6, 2e-2) * size);
      FBT_NEAR_ABS(tip[2].angular_acceleration[i], SLOPE(tip, angular_rate[i]), FBT_TOL(1e-6, 2e-2) * size);
    }
#undef SLOPE
  }
}

/* E14.11: a lumped body is its particles: on lines that lie across each other and bend far momenta and accelerations are
   the same. */
TEST(bodies_on_joined_lines_are_their_particles)
{
  static fb_body bodies;
  const double tol = FBT_TOL(1e-9, 5e-3);
  fb_state state[2];
  fb_motion motion[2];
  fb_node_motion tip;
  chain_build(TIP_BODIES);
  bodies = body;
  chain_state(&state[0], 6.0, 1.0);
  FBT_INT_EQ(fb_body_motion_eval(&bodies, &motion[0], &state[0], NULL), FB_OK);
  FBT_INT_EQ(fb_body_node_motion_eval(&bodies, &tip, &state[0], &motion[0], 3), FB_OK);
  FBT_BELOW(0.5, fbt_largest(tip.displacement, 3)); /* m, of beams of one */

  chain_build(TIP_PARTICLES);
  state[1] = state[0];
  FBT_INT_EQ(fb_state_from_velocity(&body, &state[1], motion[0].v, motion[0].w, motion[0].q_dot), FB_OK);
  FBT_INT_EQ(fb_body_motion_eval(&body, &motion[1], &state[1], NULL), FB_OK);
  FBT_BELOW(fbt_difference(state[0].pi, state[1].pi, body.n), tol * fbt_largest(state[0].pi, body.n));
  FBT_BELOW(fbt_difference(state[0].L, state[1].L, 3), tol * fbt_largest(state[0].L, 3));
  for (int k = 0; k < 3; k++) {
    const fb_real *const at[2][3] = {{motion[0].q_ddot, motion[0].w_dot, motion[0].acceleration},
                                     {motion[1].q_ddot, motion[1].w_dot, motion[1].acceleration}};
    const int n = k ? 3 : body.n;
    FBT_BELOW(fbt_difference(at[0][k], at[1][k], n), tol * fbt_largest(at[0][k], n));
  }
}

/* What `iterations` of the midpoint rule miss of all of them. */
static double missing(const fb_state *state, const fb_input *in, double dt, int iterations)
{
  static fb_implicit_work work;
  fb_state some = *state, all = *state;
  FBT_INT_EQ(fb_midpoint_step(&body, &all, &work, in, (fb_real)dt, 40), FB_OK);
  FBT_INT_EQ(fb_midpoint_step(&body, &some, &work, in, (fb_real)dt, iterations), FB_OK);
  return fbt_difference(some.q, all.q, body.n) / fbt_largest(all.q, body.n) + fbt_difference(some.quat, all.quat, 4);
}

/* E11.38: lines that hang on lines have the derivatives of their momenta, too: two iterations shrink the error by several
   hundred, without that steps do not converge. */
TEST(newton_contracts_with_joined_lines)
{
  fb_state state;
  fb_input in;
  double dt;
  memset(&in, 0, sizeof in);
  chain_build(BARE);
  body.allow_long_step = 1;
  dt = 1.0 / sqrt((double)body.limit_elastic);
  for (unsigned k = 0; k < 7; k++) {
    fbt_seed(1 + k);
    chain_state(&state, 0.5, 3.0);
    FBT_BELOW(missing(&state, &in, dt, 3), missing(&state, &in, dt, 1) / 300.0 + FBT_TOL(0.0, 1e-4));
  }
}

SUITE(line_motion, RUN_LONG(line_forces_are_the_gradient_of_the_energy), RUN_LONG(power_of_loads_is_the_rate_of_energy),
      RUN_LONG(accelerations_of_lines_are_derivatives_of_velocities), RUN(lines_conserve_energy_and_momentum),
      RUN(joined_lines_hang_on_each_other), RUN(newton_contracts_with_joined_lines),
      RUN(bodies_on_joined_lines_are_their_particles), RUN_LONG(lines_move_as_the_exact_beam),
      RUN(lines_that_twist_move_as_the_exact_beam))
