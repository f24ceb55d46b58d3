/* body.c - laws of one body. */
#include "laws.h"

static const fbl_feature features[] = {
    FBL_BODY_FEATURES,
    {"load", {"none", "dead", "follower", "hub", "distributed"}},
    {"motion", {"slow", "spinning", "flight"}},
};
enum { NO_LOAD, DEAD, FOLLOWER, ON_HUB, DISTRIBUTED };
enum { BODY_FEATURES = 13, LOAD = BODY_FEATURES, MOTION };
typedef char one_int_each[sizeof(fbl_choice) == BODY_FEATURES * sizeof(int) ? 1 : -1];

static fb_body body;
static fb_body_work body_work;
static fb_state state; /* where the motion starts */
static fb_input input;
static double size;
static fbl_choice now; /* and */
static int load_level, motion_level;
static double amplitude;    /* of the motion and of what acts: for laws of small motions */
static double wheels = 1.0; /* of the speeds of rotors */
static int varies;          /* the input, while integrators run */

static void legal(int *level)
{
  fbl_choice c;
  memcpy(&c, level, sizeof c);
  if (level[MOTION] == 2 && c.base != FB_BASE_FREE) {
    level[MOTION] = 1;
  }
  fbl_legal(&c);
  if (level[LOAD] == DISTRIBUTED && c.effects != FBL_LARGE) {
    level[LOAD] = DEAD;
  }
  memcpy(level, &c, sizeof c);
}

static void load_draw(fb_load *load, int node, int axes, double force, double torque)
{
  const double f[3] = {fbl_in(-force, force), fbl_in(-force, force), fbl_in(-force, force)};
  const double t[3] = {fbl_in(-torque, torque), fbl_in(-torque, torque), fbl_in(-torque, torque)};
  load->node = fbl_node(&now, node);
  load->axes = (fb_axes)axes;
  if (axes == FB_AXES_INERTIAL) {
    fbl_inertial_polar(load->force, f[0], f[1], f[2], 1, 1, -2);
    fbl_inertial_axial(load->torque, t[0], t[1], t[2], 1, 2, -2);
  } else {
    fbl_polar(load->force, f[0], f[1], f[2], 1, 1, -2);
    fbl_axial(load->torque, t[0], t[1], t[2], 1, 2, -2);
  }
}

static void input_draw(void)
{
  memset(&input, 0, sizeof input);
  fbl_stream("load");
  if (load_level == DISTRIBUTED) {
    input.distributed = fbl_wind;
    input.user = &size;
  } else if (load_level != NO_LOAD) {
    const int hub = load_level == ON_HUB, axes = load_level == DEAD ? FB_AXES_INERTIAL : FB_AXES_NODE;
    input.n_load = 2;
    for (int k = 0; k < 2; k++) {
      load_draw(&input.load[fbl_seen.reverse ? 1 - k : k], hub ? 0 : 1, hub && k ? FB_AXES_BODY : axes, 2.0 * amplitude,
                (hub ? 2.0 : 0.3) * amplitude);
    }
  }
  fbl_stream("motor");
  for (int r = 0; r < body.n_rotor; r++) {
    const double torque = amplitude * fbl_in(-0.05, 0.05);
    const double momentum = wheels * amplitude * fbl_in(-2.0, 2.0); /* about the axis, which is mirrored */
    input.rotor[r].torque = body.rotor[r].given ? FB_R(0.0) : fbl_unit(torque, 1, 2, -2);
    input.rotor[r].momentum = body.rotor[r].given ? fbl_unit(momentum, 1, 2, -1) : FB_R(0.0);
  }
}

static fb_status state_draw(void)
{
  static const double q[4] = {0.5, -0.5, 0.1, 0.7};
  static const double pace[] = {0.1, 1.5, 1.5}, speeds[] = {0.3, 0.3, 400.0};
  const double fast = amplitude * pace[motion_level],
               spin[3] = {fbl_in(-fast, fast), fbl_in(-fast, fast), fbl_in(-fast, fast)};
  fb_real v[3] = {0}, w[3] = {0}, q_dot[FB_MAX_MODES] = {0}, u[3];
  fb_status status = fb_state_init(&body, &state);
  fbl_quat(state.quat, q, 1);
  for (int i = 0; i < 3; i++) {
    state.rho[i] = fbl_unit(fbl_seen.shift[i], 0, 1, 0);
  }
  fbl_deflect(state.q, q_dot, &body, size);
  for (int a = 0; a < body.n; a++) {
    state.q[a] *= (fb_real)amplitude;
    q_dot[a] *= (fb_real)amplitude;
  }
  fbl_stream("velocity");
  /* fb_effects_check: few effects lack the loads w x v of O on the modes, steps are then of order 1 */
  if (body.base == FB_BASE_FREE ||
      (body.base == FB_BASE_PRESCRIBED && now.effects != FBL_LINEAR && now.effects != FBL_SPIN)) {
    const double speed = amplitude * speeds[motion_level];
    fbl_polar(v, fbl_in(-speed, speed), fbl_in(-speed, speed), fbl_in(-speed, speed), 0, 1, -1);
  }
  fbl_axial(w, spin[0], spin[1], spin[2], 0, 0, -1);
  if (body.base == FB_BASE_HINGED) {
    w[0] = w[1] = FB_R(0.0);
  }
  if (body.base == FB_BASE_PRESCRIBED) {
    memcpy(input.v, v, sizeof v);
    memcpy(input.w, w, sizeof w);
  }
  for (int r = 0; r < body.n_rotor; r++) { /* as the input has them */
    state.pi[body.n + r] = input.rotor[r].momentum;
  }
  status = status ? status : fb_state_from_velocity(&body, &state, v, w, q_dot);
  fbl_stream("wheels");
  for (int r = 0; r < body.n_rotor && status == FB_OK; r++) {
    const double speed = wheels * amplitude * fbl_in(-60.0, 60.0), angle = fbl_in(-1.0, 1.0);
    if (!body.rotor[r].given) {
      status = fb_state_rotor_set(&body, &state, r, fbl_unit(speed, 0, 0, -1), (fb_real)angle, &input);
    }
  }
  fbl_inertial_polar(u, fbl_seen.boost[0], fbl_seen.boost[1], fbl_seen.boost[2], 0, 1, -1);
  for (int i = 0; i < 3 && body.base == FB_BASE_FREE; i++) {
    state.u[i] += u[i];
  }
  return status;
}

static fb_status draw_levels(const int *level)
{
  fb_status status;
  memcpy(&now, level, sizeof now);
  load_level = level[LOAD];
  motion_level = level[MOTION];
  status = fbl_make(&body, &now, &size);
  if (status != FB_OK) {
    return status;
  }
  input_draw();
  fbl_stream("spin");
  return state_draw();
}

static fb_status draw(const int *level)
{
  amplitude = 1.0;
  varies = 0;
  return draw_levels(level);
}

/* Draws with other levels, if they are others, or of another amplitude: for laws that would say nothing of the drawn model. */
static fb_status near_by(const fbl_choice *c, int load, int motion, double size_of_motion)
{
  int level[FBL_FEATURES] = {0}, before[FBL_FEATURES] = {0};
  memcpy(before, &now, sizeof now);
  memcpy(level, c, sizeof *c);
  before[LOAD] = load_level;
  before[MOTION] = motion_level;
  level[LOAD] = load;
  level[MOTION] = motion;
  legal(level);
  if (size_of_motion >= 1.0 && memcmp(level, before, sizeof level) == 0) {
    return FB_OK;
  }
  amplitude = size_of_motion;
  return draw_levels(level);
}

/* The input at the time t of the model, which begins as it is drawn: loads and given momenta grow, a base that is
   prescribed accelerates. */
static void input_at(fb_input *in, double t)
{
  const double grow = 1.0 + 0.4 * t / (double)fbl_unit(1.0, 0, 0, 1);
  *in = input;
  in->t = (fb_real)t;
  for (int k = 0; k < in->n_load; k++) {
    for (int i = 0; i < 3; i++) {
      in->load[k].force[i] *= (fb_real)grow;
      in->load[k].torque[i] *= (fb_real)grow;
    }
  }
  for (int r = 0; r < body.n_rotor; r++) {
    if (body.rotor[r].given) {
      in->rotor[r].momentum *= (fb_real)grow;
      in->rotor[r].torque = input.rotor[r].momentum * fbl_unit(0.4, 0, 0, -1);
    }
  }
  if (body.base == FB_BASE_PRESCRIBED && now.effects != FBL_LINEAR && now.effects != FBL_SPIN) { /* as for v */
    fbl_polar(in->v_dot, 0.3 * amplitude, -0.2 * amplitude, 0.4 * amplitude, 0, 1, -2);
    fbl_axial(in->w_dot, 0.2 * amplitude, 0.3 * amplitude, -0.1 * amplitude, 0, 0, -2);
    for (int i = 0; i < 3; i++) {
      in->v[i] += (fb_real)t * in->v_dot[i];
      in->w[i] += (fb_real)t * in->w_dot[i];
    }
  }
}

/* ---- five states that follow each other, and all that can be asked of them */

typedef struct look {
  fb_state state;
  fb_input input;
  fb_motion motion;
  fb_node_motion node[FB_MAX_NODES];
  fb_energy energy;
  fb_momentum momentum;
  fb_body_limit limit;
  fbl_points told;
} look;

static look path[5];
static double dt;

static fb_status look_at(look *at, const fb_state *where, const fb_input *in)
{
  fb_status status;
  memset(&fbl_told, 0, sizeof fbl_told);
  status = fb_body_motion_eval(&body, &at->motion, where, in);
  at->told = fbl_told;
  at->state = *where;
  at->input = *in;
  for (int k = 0; k < body.n_node && status == FB_OK; k++) {
    status = fb_body_node_motion_eval(&body, &at->node[k], where, &at->motion, k);
  }
  status = status ? status : fb_body_limit_eval(&body, &at->limit, where, in);
  status = status ? status : fb_body_energy_eval(&body, &at->energy, where, in);
  return status ? status : fb_body_momentum_eval(&body, &at->momentum, where, in);
}

/* The longest step that rk4 takes from the start, all: every integrator; at most a tenth of a unit of time. */
static fb_status longest(double *step, int all)
{
  fb_body_limit limit;
  const fb_status status = fb_body_limit_eval(&body, &limit, &state, &input);
  const double most[] = {0.1 * (double)fbl_unit(1.0, 0, 0, 1), (double)limit.rk4, (double)limit.implicit,
                         (double)limit.exponential};
  *step = most[0];
  for (int k = 1; k < (all ? 4 : 2); k++) {
    *step = most[k] < *step ? most[k] : *step;
  }
  return status;
}

/* h: in units of the longest step. The input is then that of the middle. */
static fb_status walk(double h)
{
  static fb_rk4_work work;
  static fb_input in[3];
  fb_state at = state;
  fb_status status = longest(&dt, 0);
  dt *= h;
  for (int k = 0; k < 5 && status == FB_OK; k++) {
    for (int i = 0; i < 3; i++) {
      input_at(&in[i], (k + 0.5 * i) * dt);
    }
    status = look_at(&path[k], &at, &in[0]);
    status = status || k == 4 ? status : fb_rk4_step(&body, &at, &work, &in[0], &in[1], &in[2], (fb_real)dt);
  }
  input = path[2].input;
  return status;
}

#define SLOPE(member) fbl_slope(&path[0].member, sizeof(look) / sizeof(fb_real), dt)

/* ---- laws: derivatives */

/* Largest |difference| of derivatives from values, and the largest value, over the three axes. */
static double velocities(double h)
{
  double miss = 0.0;
  FBL_TRY(walk(h));
  for (int k = 0; k < body.n_node; k++) {
    double w[3], v_off = 0.0, w_off = 0.0;
    fbl_turning(w, path[0].node[k].quat, sizeof(look) / sizeof(fb_real), dt);
    for (int i = 0; i < 3; i++) {
      v_off = larger(v_off, fabs(SLOPE(node[k].position[i]) - (double)path[2].node[k].velocity[i]));
      w_off = larger(w_off, fabs(w[i] - (double)path[2].node[k].angular_rate[i]));
    }
    miss = larger(miss, v_off / (fbl_largest(path[2].node[k].velocity, 3) + 0.1 * (double)fbl_unit(size, 0, 1, -1)));
    miss = larger(miss, w_off / (fbl_largest(path[2].node[k].angular_rate, 3) + 0.1 * (double)fbl_unit(1.0, 0, 0, -1)));
  }
  return miss;
}

/* What a distributed load is told of the lines. */
static double points(double h)
{
  FBL_TRY(walk(h));
  return input.distributed ? fbl_points_miss(&path[0].told, sizeof(look) / sizeof(fb_real), dt, size) : FBL_NONE;
}

static double accelerations(double h)
{
  double miss = 0.0;
  FBL_TRY(walk(h));
  for (int k = 0; k < body.n_node; k++) {
    double a_off = 0.0, w_off = 0.0;
    fb_imu imu;
    fb_real g[3], felt[3];
    FBL_TRY(fb_body_gravity_eval(&body, g, path[2].node[k].position));
    fb_imu_eval(&imu, &path[2].node[k], g);
    to_inertial(felt, path[2].node[k].quat, imu.specific_force);
    for (int i = 0; i < 3; i++) {
      a_off = larger(a_off, fabs(SLOPE(node[k].velocity[i]) - (double)path[2].node[k].acceleration[i]));
      a_off = larger(a_off, fabs(SLOPE(node[k].velocity[i]) - (double)felt[i] - (double)g[i]));
      w_off = larger(w_off, fabs(SLOPE(node[k].angular_rate[i]) - (double)path[2].node[k].angular_acceleration[i]));
    }
    miss = larger(miss, a_off / (fbl_largest(path[2].node[k].acceleration, 3) + (double)fbl_unit(size, 0, 1, -2)));
    miss =
        larger(miss, w_off / (fbl_largest(path[2].node[k].angular_acceleration, 3) + (double)fbl_unit(1.0, 0, 0, -2)));
  }
  return miss;
}

static double coordinates(double h)
{
  double off[3] = {0.0, 0.0, 0.0};
  FBL_TRY(walk(h));
  for (int a = 0; a < body.n; a++) {
    off[0] = larger(off[0], fabs(SLOPE(state.q[a]) - (double)path[2].motion.q_dot[a]));
    off[1] = larger(off[1], fabs(SLOPE(motion.q_dot[a]) - (double)path[2].motion.q_ddot[a]));
  }
  for (int i = 0; i < 3; i++) {
    off[2] = larger(off[2], fabs(SLOPE(motion.w[i]) - (double)path[2].motion.w_dot[i]));
  }
  off[0] = body.n ? off[0] / larger(1e-300, fbl_largest(path[2].motion.q_dot, body.n)) : 0.0;
  off[1] = body.n ? off[1] / larger(1e-300, fbl_largest(path[2].motion.q_ddot, body.n)) : 0.0;
  off[2] /= fbl_largest(path[2].motion.w_dot, 3) + (double)fbl_unit(1.0, 0, 0, -2);
  for (int k = 0; k < 5; k++) { /* h is L in body axes */
    const fb_state *const at = &path[k].state;
    fb_real R[9], own[3];
    fb_quat_to_mat33(R, at->quat);
    fb_mat33_mulT_vec3(own, R, at->L);
    off[2] = larger(off[2], fbl_difference(own, at->h, 3) / (fbl_largest(own, 3) + (double)fbl_unit(1.0, 1, 2, -1)));
  }
  return larger(off[0], larger(off[1], off[2]));
}

static double rotor_angles(double h)
{
  double miss = 0.0;
  if (body.n_rotor == 0) {
    return FBL_NONE;
  }
  FBL_TRY(walk(0.1 * h)); /* angles jump by a turn: steps in which a rotor turns little */
  for (int r = 0; r < body.n_rotor; r++) {
    const double speed = (double)path[2].motion.rotor_speed[r];
    const double turn = (double)path[4].state.q[body.n + r] - (double)path[0].state.q[body.n + r];
    if (fabs(turn - speed * 4.0 * dt) < 1.0) { /* not over half a turn */
      miss = larger(miss, fabs(SLOPE(state.q[body.n + r]) - speed) / (fabs(speed) + (double)fbl_unit(1.0, 0, 0, -1)));
    }
  }
  return miss;
}

/* ---- laws: balances */

/* Loads of the input at path[2], inertial axes: force and moment at the node. */
static void load_now(fb_real force[3], fb_real torque[3], const fb_load *load)
{
  const look *const at = &path[2];
  const fb_real *const quat = load->axes == FB_AXES_NODE ? at->node[load->node].quat : at->state.quat;
  if (load->axes == FB_AXES_INERTIAL) {
    memcpy(force, load->force, 3 * sizeof *force);
    memcpy(torque, load->torque, 3 * sizeof *torque);
  } else {
    to_inertial(force, quat, load->force);
    to_inertial(torque, quat, load->torque);
  }
}

/* Load of the imbalance of rotor r at path[2], inertial axes, at its node: U spin^2 along x cos(angle) + y sin(angle). */
static const fb_node_motion *imbalance_now(fb_real force[3], fb_real torque[3], int r)
{
  const fb_rotor *const rotor = &body.rotor[r];
  const fb_node_motion *const node = &path[2].node[rotor->node];
  const double spin = (double)path[2].motion.rotor_momentum[r] / (double)rotor->inertia, square = spin * spin;
  const double angle = (double)path[2].state.q[body.n + r], at = angle + (double)rotor->dynamic_phase;
  fb_real y[3], f[3], t[3];
  fb_vec3_cross(y, rotor->axis, rotor->across);
  for (int i = 0; i < 3; i++) {
    const double x = (double)rotor->across[i];
    f[i] = (fb_real)((double)rotor->static_imbalance * square * (cos(angle) * x + sin(angle) * (double)y[i]));
    t[i] = (fb_real)((double)rotor->dynamic_imbalance * square * (cos(at) * x + sin(at) * (double)y[i]));
  }
  to_inertial(force, node->quat, f);
  to_inertial(torque, node->quat, t);
  return node;
}

static fb_line_motion line[FB_MAX_LINE_POINTS];

/* Power of a rotor's motor and friction, about its axis: what changes its momentum, times its speed. */
static double rotor_power(int r)
{
  return SLOPE(state.pi[body.n + r]) * (double)path[2].motion.rotor_speed[r];
}

static double damping_power(void)
{
  double sum = 0.0;
  const fb_real *const x = path[2].motion.q_dot;
  if (!(body.effects & FB_EFFECT_DAMPING)) {
    return 0.0;
  }
  for (int a = 0; a < body.n; a++) {
    sum += (double)body.C.diagonal[a] * (double)x[a] * (double)x[a];
  }
  for (int k = 0; k < body.C.n_term; k++) {
    sum += 2.0 * (double)body.C.term[k].c * (double)x[body.C.term[k].a] * (double)x[body.C.term[k].b];
  }
  return -sum;
}

static double energy_rate(double h)
{
  double rate, power, size_of = 0.0;
  int n = 0;
  FBL_TRY(walk(h));
  rate = SLOPE(energy.kinetic) + SLOPE(energy.strain) + SLOPE(energy.gravity);
  power = damping_power();
  size_of = fabs(SLOPE(energy.kinetic)) + fabs(SLOPE(energy.strain)) + fabs(SLOPE(energy.gravity)) + fabs(power);
  for (int k = 0; k < input.n_load; k++) {
    const fb_node_motion *const node = &path[2].node[input.load[k].node];
    fb_real force[3], torque[3];
    load_now(force, torque, &input.load[k]);
    power += dot(force, node->velocity) + dot(torque, node->angular_rate);
    size_of += fabs(dot(force, node->velocity)) + fabs(dot(torque, node->angular_rate));
  }
  for (int r = 0; r < body.n_rotor; r++) {
    fb_real force[3], torque[3];
    const fb_node_motion *const node = imbalance_now(force, torque, r);
    power += rotor_power(r) + dot(force, node->velocity) + dot(torque, node->angular_rate);
    size_of += fabs(rotor_power(r)) + fabs(dot(force, node->velocity)) + fabs(dot(torque, node->angular_rate));
  }
  if (input.distributed && body.n_rotor == 0 && now.gravity != FBL_CENTER) {
    FBL_TRY(fb_body_lines_eval(&body, line, &n, &path[2].state, &path[2].motion, &input));
    for (int k = 0; k < n; k++) {
      power += dot(line[k].at.force, line[k].at.velocity);
      size_of += fabs(dot(line[k].at.force, line[k].at.velocity));
    }
  } else if (input.distributed) {
    return FBL_NONE;
  }
  power += dot(path[2].motion.reaction_force, path[2].motion.v) + dot(path[2].motion.reaction_torque, path[2].motion.w);
  return fabs(rate - power) / (size_of + (double)path[2].energy.kinetic * (double)fbl_unit(1.0, 0, 0, -1) + 1e-300);
}

/* -dU/d(shift), -dU/d(rotation about the inertial origin) of the energy of gravity: its force and moment. */
static double gravity_slope(int i, int rotate)
{
  const double d = rotate ? 1e-3 : 1e-3 * (double)fbl_unit(size, 0, 1, 0);
  fb_real U[5];
  for (int k = 0; k < 5; k++) {
    fb_state at = path[2].state;
    fb_energy energy;
    fb_real turn[3] = {0}, q[4], R[9];
    if (rotate) {
      turn[i] = (fb_real)(d * (k - 2));
      fb_quat_from_rotvec(q, turn);
      fb_quat_to_mat33(R, q);
      fb_mat33_mul_vec3(at.rho, R, path[2].state.rho);
      fb_quat_mul(at.quat, q, path[2].state.quat);
    } else {
      at.rho[i] += (fb_real)(d * (k - 2));
    }
    if (fb_body_energy_eval(&body, &energy, &at, &input) != FB_OK) {
      return HUGE_VAL;
    }
    U[k] = energy.gravity;
  }
  return -fbl_slope(U, 1, d);
}

static double momentum_rates(double h)
{
  double force[3], moment[3], f_size = 0.0, m_size = 0.0, miss = 0.0;
  fb_real f[3], t[3], arm[3];
  if (input.distributed) {
    return FBL_NONE;
  }
  FBL_TRY(walk(h));
  to_inertial(f, path[2].state.quat, path[2].motion.reaction_force);
  to_inertial(t, path[2].state.quat, path[2].motion.reaction_torque);
  fb_vec3_cross(arm, path[2].state.rho, f);
  for (int i = 0; i < 3; i++) {
    force[i] =
        (double)f[i] + (body.effects & (FB_EFFECT_GRAVITY | FB_EFFECT_CENTRAL_GRAVITY) ? gravity_slope(i, 0) : 0.0);
    moment[i] = (double)t[i] + (double)arm[i] +
                (body.effects & (FB_EFFECT_GRAVITY | FB_EFFECT_CENTRAL_GRAVITY) ? gravity_slope(i, 1) : 0.0);
  }
  for (int k = 0; k < input.n_load; k++) {
    load_now(f, t, &input.load[k]);
    fb_vec3_cross(arm, path[2].node[input.load[k].node].position, f);
    for (int i = 0; i < 3; i++) {
      force[i] += (double)f[i];
      moment[i] += (double)t[i] + (double)arm[i];
    }
  }
  for (int r = 0; r < body.n_rotor; r++) {
    const fb_node_motion *const node = imbalance_now(f, t, r);
    fb_vec3_cross(arm, node->position, f);
    for (int i = 0; i < 3; i++) {
      force[i] += (double)f[i];
      moment[i] += (double)t[i] + (double)arm[i];
    }
  }
  for (int i = 0; i < 3; i++) {
    f_size = larger(f_size, fabs(force[i]));
    m_size = larger(m_size, fabs(moment[i]));
  }
  f_size +=
      (fbl_largest(path[2].momentum.linear, 3) + (double)fbl_unit(1.0, 1, 1, -1)) * (double)fbl_unit(1.0, 0, 0, -1);
  m_size +=
      (fbl_largest(path[2].momentum.angular, 3) + (double)fbl_unit(1.0, 1, 2, -1)) * (double)fbl_unit(1.0, 0, 0, -1);
  for (int i = 0; i < 3; i++) {
    miss = larger(miss, fabs(SLOPE(momentum.linear[i]) - force[i]) / f_size);
    miss = larger(miss, fabs(SLOPE(momentum.angular[i]) - moment[i]) / m_size);
  }
  return miss;
}

/* ---- laws: internal loads of lines */

static fb_line_motion along[5][FB_MAX_LINE_POINTS];

typedef struct whole { /* momentum, angular momentum about the inertial origin, mass, first moment */
  double P[3], H[3], mass, first[3];
} whole;

/* Adds what is at a point of a line: mass m, first moment S, inertia J about the point, packed, both in line axes, which
   follow the section; axes: section to line axes. */
static void whole_add(whole *all, const fb_line_point *p, const fb_real axes[9], fb_real m, const fb_real S[3],
                      const fb_real J[6])
{
  const fb_real square[9] = {J[0], J[1], J[2], J[1], J[3], J[4], J[2], J[4], J[5]};
  fb_real D[9], s[3], v[3], x[3], y[3], spin[3];
  for (int k = 0; k < 9; k++) { /* line to inertial axes */
    D[k] = FB_R(0.0);
    for (int i = 0; i < 3; i++) {
      D[k] += p->R[3 * (k / 3) + i] * axes[3 * (k % 3) + i];
    }
  }
  fb_mat33_mulT_vec3(x, D, p->angular_rate);
  fb_mat33_mul_vec3(y, square, x);
  fb_mat33_mul_vec3(spin, D, y);
  fb_mat33_mul_vec3(s, D, S);
  fb_vec3_cross(v, p->angular_rate, s);
  for (int i = 0; i < 3; i++) {
    v[i] += m * p->velocity[i];
  }
  fb_vec3_cross(x, p->position, v);
  fb_vec3_cross(y, s, p->velocity);
  all->mass += (double)m;
  for (int i = 0; i < 3; i++) {
    all->P[i] += (double)v[i];
    all->H[i] += (double)x[i] + (double)y[i] + (double)spin[i];
    all->first[i] += (double)m * (double)p->position[i] + (double)s[i];
  }
}

/* All lines, from the motion of their points; a root at rest has the mass of the sections behind it. */
static void lines_whole(whole *all, const fb_line_motion *points)
{
  const fb_lines *const lines = &body.lines;
  int at = 0;
  memset(all, 0, sizeof *all);
  for (int l = 0; l < lines->n_line; l++) {
    const fb_line *const own = &lines->line[l];
    const fb_line_station *const root = &lines->root[l];
    if ((double)root->length > 0.0) {
      const fb_line_side *const side = &lines->side[root->side - 1];
      whole_add(all, &points[at++].at, root->axes, side->mass[1], side->first[1], side->moment[1]);
    }
    for (int j = own->point; j < own->point + own->count; j++) {
      const fb_real m = lines->mass[j], *const c = &lines->center[3 * j];
      const fb_real S[3] = {m * c[0], m * c[1], m * c[2]};
      fb_real J[6]; /* about the point */
      memcpy(J, &lines->inertia[6 * j], sizeof J);
      J[0] += m * (c[1] * c[1] + c[2] * c[2]);
      J[1] -= m * c[0] * c[1];
      J[2] -= m * c[0] * c[2];
      J[3] += m * (c[2] * c[2] + c[0] * c[0]);
      J[4] -= m * c[1] * c[2];
      J[5] += m * (c[0] * c[0] + c[1] * c[1]);
      whole_add(all, &points[at++].at, lines->station[j].axes, m, S, J);
    }
  }
}

/* sum += force and torque at x about the inertial origin; size: the largest. */
static void act(double sum[6], double size_of[2], const fb_real *x, const fb_real *force, const fb_real *torque)
{
  fb_real arm[3];
  fb_vec3_cross(arm, x, force);
  for (int i = 0; i < 3; i++) {
    sum[i] += (double)force[i];
    sum[3 + i] += (double)arm[i] + (double)torque[i];
  }
  size_of[0] = larger(size_of[0], fbl_largest(force, 3));
  size_of[1] = larger(size_of[1], larger(fbl_largest(arm, 3), fbl_largest(torque, 3)));
}

/* What the lines exert at their roots on the hub is what acts on them, less the rate of their momentum. */
static double loads_at_roots(double h)
{
  whole all[5];
  double sum[6] = {0.0}, size_of[2] = {0.0, 0.0}, miss = 0.0;
  int n = 0;
  fbl_choice c = now;
  if (now.effects != FBL_LARGE) {
    return FBL_NONE;
  }
  c.rotors = c.rotors > FBL_ON_HUB ? FBL_ON_HUB : c.rotors;
  c.gravity = c.gravity == FBL_CENTER ? FBL_GRAVITY : c.gravity;
  FBL_TRY(near_by(&c, load_level, motion_level, 1.0));
  FBL_TRY(walk(h));
  for (int k = 0; k < 5; k++) {
    FBL_TRY(fb_body_lines_eval(&body, along[k], &n, &path[k].state, &path[k].motion, &path[k].input));
    lines_whole(&all[k], along[k]);
  }

  /* at the roots, reversed, distributed, at nodes */
  for (int k = 0, l = 0; l < body.lines.n_line; l++) {
    const fb_line_motion *const root = &along[2][k];
    const int rests = (double)body.lines.root[l].length > 0.0;
    fb_real force[3], torque[3];
    fb_mat33_mul_vec3(force, root->at.R, root->force);
    fb_mat33_mul_vec3(torque, root->at.R, root->moment);
    for (int i = 0; i < 3; i++) {
      force[i] = -force[i];
      torque[i] = -torque[i];
    }
    if (body.lines.line[l].hangs == 0) {
      act(sum, size_of, root->at.position, force, torque);
    }
    k += rests + body.lines.line[l].count;
  }
  for (int k = 0; k < n; k++) {
    act(sum, size_of, along[2][k].at.position, along[2][k].at.force, along[2][k].at.torque);
  }
  for (int k = 0; k < input.n_load; k++) {
    const int node = input.load[k].node;
    fb_real force[3], torque[3];
    load_now(force, torque, &input.load[k]);
    if (body.node[node].line.line > 0) {
      act(sum, size_of, path[2].node[node].position, force, torque);
    }
  }
  if (body.effects & FB_EFFECT_GRAVITY) {
    fb_real x[3], force[3];
    const fb_real none[3] = {0};
    for (int i = 0; i < 3; i++) {
      x[i] = (fb_real)(all[2].first[i] / all[2].mass);
      force[i] = (fb_real)(all[2].mass * (double)body.gravity[i]);
    }
    act(sum, size_of, x, force, none);
  }

  /* a node near a root bears what lies between the points beside it; farther out loads have peaks between points */
  for (int node = 0; node < body.n_node; node++) {
    const fb_line_motion *a = NULL, *b = NULL;
    const double x = (double)body.node[node].line.x;
    double end = 0.0;
    fb_node_loads loads;
    if (body.node[node].line.line == 0) {
      continue;
    }
    FBL_TRY(fb_body_node_loads_eval(&body, &loads, &path[2].state, &path[2].motion, &path[2].input, node));
    for (int k = 0; k < n; k++) {
      const fb_line_motion *const p = &along[2][k];
      if (p->at.line == body.node[node].line.line - 1) {
        a = (double)p->at.x <= x ? p : a;
        b = (double)p->at.x >= x && !b ? p : b;
        end = (double)p->at.x;
      }
    }
    if (!a || !b || a == b || x > 0.2 * end) {
      continue;
    }
    for (int turns = 0; turns < 2; turns++) { /* its length: the axes of a node are not those of the section */
      const fb_real *const own = turns ? loads.moment : loads.force;
      const double part = (x - (double)a->at.x) / ((double)b->at.x - (double)a->at.x);
      fb_real from[3], to[3], between[3];
      double wide;
      fb_mat33_mul_vec3(from, a->at.R, turns ? a->moment : a->force);
      fb_mat33_mul_vec3(to, b->at.R, turns ? b->moment : b->force);
      for (int i = 0; i < 3; i++) {
        between[i] = (fb_real)((1.0 - part) * (double)from[i] + part * (double)to[i]);
      }
      wide = fabs(sqrt(dot(from, from)) - sqrt(dot(to, to))) + 0.1 * size_of[turns];
      miss = larger(miss, fabs(sqrt(dot(own, own)) - sqrt(dot(between, between))) > wide ? 1.0 : 0.0);
    }
  }

  for (int i = 0; i < 3; i++) {
    fb_real p[5], q[5];
    for (int k = 0; k < 5; k++) {
      p[k] = (fb_real)all[k].P[i];
      q[k] = (fb_real)all[k].H[i];
    }
    miss = larger(miss, fabs(sum[i] - fbl_slope(p, 1, dt)) / (size_of[0] + (double)fbl_unit(1.0, 1, 1, -2)));
    miss = larger(miss, fabs(sum[3 + i] - fbl_slope(q, 1, dt)) / (size_of[1] + (double)fbl_unit(1.0, 1, 2, -2)));
  }
  return miss;
}

/* ---- laws: the same scene seen otherwise */

enum { STEPS = 20 };

/* Runs some steps of the drawn scene and looks at its end. dt of the first scene, in its own unit of time. */
static fb_status motion_of(look *end, double step)
{
  static fb_rk4_work work;
  fb_state at = state;
  fb_status status = FB_OK;
  for (int k = 0; k < STEPS && status == FB_OK; k++) {
    status = fb_rk4_step(&body, &at, &work, &input, &input, &input, (fb_real)step);
  }
  return status ? status : look_at(end, &at, &input);
}

/* Largest difference of the two ends over that of the motion itself, by nodes; the second is seen as fbl_seen has it. */
static double ends_differ(const look *a, const look *b)
{
  double miss = 0.0;
  const double length = (double)fbl_unit(size, 0, 1, 0), speed = (double)fbl_unit(size, 0, 1, -1);
  for (int k = 0; k < body.n_node; k++) {
    const fb_node_motion *const p = &a->node[k], *const q = &b->node[fbl_node(&now, k)];
    fb_real x[3], v[3], acc[3], w[3], u[3];
    fbl_inertial_polar(x, (double)p->position[0], (double)p->position[1], (double)p->position[2], 0, 1, 0);
    fbl_inertial_polar(v, (double)p->velocity[0], (double)p->velocity[1], (double)p->velocity[2], 0, 1, -1);
    fbl_inertial_polar(acc, (double)p->acceleration[0], (double)p->acceleration[1], (double)p->acceleration[2], 0, 1,
                       -2);
    fbl_inertial_axial(w, (double)p->angular_rate[0], (double)p->angular_rate[1], (double)p->angular_rate[2], 0, 0, -1);
    fbl_polar(u, (double)p->displacement[0], (double)p->displacement[1], (double)p->displacement[2], 0, 1, 0);
    for (int i = 0; i < 3; i++) {
      const double shift = (double)fbl_unit(fbl_seen.shift[i], 0, 1, 0);
      miss = larger(miss, fabs((double)q->position[i] - (double)x[i] - shift) / length);
    }
    miss = larger(miss, fbl_difference(q->velocity, v, 3) / (speed + fbl_largest(v, 3)));
    miss = larger(miss,
                  fbl_difference(q->acceleration, acc, 3) / ((double)fbl_unit(size, 0, 1, -2) + fbl_largest(acc, 3)));
    miss = larger(miss, fbl_difference(q->angular_rate, w, 3) / ((double)fbl_unit(1.0, 0, 0, -1) + fbl_largest(w, 3)));
    miss = larger(miss, fbl_difference(q->displacement, u, 3) / length);
  }
  for (int k = 0; k < 3; k++) {
    const fb_real limit[3] = {a->limit.rk4, a->limit.implicit, a->limit.exponential};
    const fb_real seen[3] = {b->limit.rk4, b->limit.implicit, b->limit.exponential};
    const double rate = 1.0 / (double)fbl_unit((double)limit[k], 0, 0, 1), own = 1.0 / (double)seen[k];
    miss = larger(miss, 1e-3 * fabs(own - rate) / (rate + (double)fbl_unit(1e-3, 0, 0, -1)));
  }
  miss = larger(miss, fabs((double)b->energy.strain - (double)fbl_unit((double)a->energy.strain, 1, 2, -2)) /
                          ((double)fbl_unit((double)a->energy.kinetic + (double)a->energy.strain, 1, 2, -2) + 1e-300));
  return miss;
}

/* The scene as it is, then as `view` has it. */
static double seen_as(const fbl_view *view)
{
  static look first, second;
  double step, miss;
  fb_real boost[3];
  fbl_plain();
  fbl_seen.undeformed = view->undeformed;
  FBL_TRY(fbl_draw_again());
  FBL_TRY(longest(&step, 0));
  step *= 0.3;
  FBL_TRY(motion_of(&first, step));
  fbl_seen = *view;
  FBL_TRY(fbl_draw_again());
  FBL_TRY(motion_of(&second, step * view->s));
  fbl_inertial_polar(boost, view->boost[0], view->boost[1], view->boost[2], 0, 1, -1);
  for (int k = 0; k < body.n_node; k++) {
    for (int i = 0; i < 3; i++) {
      second.node[k].position[i] -= (fb_real)((double)boost[i] * STEPS * step);
      second.node[k].velocity[i] -= boost[i];
    }
  }
  miss = ends_differ(&first, &second);
  fbl_plain();
  return miss;
}

static double turned_and_shifted(double h)
{
  (void)h;
  return seen_as(&fbl_turned);
}

static double boosted(double h)
{
  static const fbl_view view = {
      1.0, 1.0, 1.0, 0, 0, 0, {1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {3000.0, -5000.0, 4000.0}};
  (void)h;
  return body.base != FB_BASE_FREE || now.gravity == FBL_CENTER ? FBL_NONE : seen_as(&view);
}

static double other_units(double h)
{
  (void)h;
  return seen_as(&fbl_other_units);
}

static double mirrored(double h)
{
  (void)h;
  return now.rotors == FBL_UNBALANCED ? FBL_NONE
                                      : seen_as(&fbl_mirrored); /* the library chooses where its angle is zero */
}

static double reordered(double h)
{
  (void)h;
  return now.parts == FBL_TWO_BEAMS || input.n_load > 1 ? seen_as(&fbl_reordered) : FBL_NONE;
}

/* ---- laws: one method against another */

/* Lines of plane bending are lines: without their own formulas the motion is the same. */
static double plane_lines(double h)
{
  static look first, second;
  fbl_choice c = now;
  double step;
  int plane = 0;
  (void)h;
  if (now.effects != FBL_LARGE) {
    return FBL_NONE;
  }
  c.section = c.section == FBL_TAPER ? FBL_TAPER : FBL_UNIFORM;
  c.parts = c.parts == FBL_TWO_BEAMS ? FBL_TWO_BEAMS : FBL_ONE_BEAM;
  c.lumps = c.lumps > FBL_POINT ? FBL_POINT : c.lumps;
  c.shear = 0;
  c.modes = FBL_ONE_PLANE;
  FBL_TRY(near_by(&c, load_level, motion_level, 1.0));
  FBL_TRY(longest(&step, 0));
  FBL_TRY(motion_of(&first, 0.3 * step));
  for (int l = 0; l < body.lines.n_line; l++) {
    plane |= body.lines.line[l].plane;
    body.lines.line[l].plane = 0;
  }
  FBL_TRY(motion_of(&second, 0.3 * step));
  return plane ? ends_differ(&first, &second) : 1.0;
}

/* A body in units of four times the mass and half the time is the plain one by factors of stiffness and masses. Gravity and
   rotors are none of these, nor the masses of lines. */
static double by_factors(double h)
{
  static look first, second;
  static fb_body light;
  static fb_state own;
  fb_real v[3], w[3], q_dot[FB_MAX_MODES];
  fbl_view view = {4.0, 1.0, 0.5, 0, 0, 0, {1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  fb_body_factors by = {FB_R(16.0), FB_R(1.0), FB_R(4.0), FB_R(1.0), FB_R(1.0), FB_R(0.0), {0}, {0}};
  fbl_choice c = now;
  double step;
  (void)h;
  c.gravity = FBL_NO_GRAVITY;
  c.rotors = FBL_NO_ROTOR;
  if (now.effects == FBL_LARGE) {
    view.kg = 1.0;
    by.stiffness = FB_R(4.0);
    by.mass = FB_R(1.0);
  }
  FBL_TRY(near_by(&c, load_level, motion_level, 0.5));
  FBL_TRY(look_at(&second, &state, &input));
  light = body;
  own = state;
  fbl_seen = view;
  FBL_TRY(near_by(&c, load_level, motion_level, 0.5));
  fbl_plain();
  FBL_TRY(longest(&step, 0));
  FBL_TRY(motion_of(&first, 0.3 * step));
  FBL_TRY(fb_body_scale(&body, &body_work, &light, &by));
  for (int i = 0; i < 3; i++) {
    v[i] = second.motion.v[i] / (fb_real)view.s;
    w[i] = second.motion.w[i] / (fb_real)view.s;
  }
  for (int a = 0; a < body.n; a++) { /* q has the unit of the plain one */
    q_dot[a] = second.motion.q_dot[a] / (fb_real)view.s;
  }
  FBL_TRY(fb_state_from_velocity(&body, &own, v, w, q_dot));
  state = own;
  FBL_TRY(motion_of(&second, 0.3 * step));
  return ends_differ(&first, &second);
}

static fb_implicit_work implicit;
static fb_rk4_work rk4;
static fb_exponential exponential;
static fb_exponential_work exponential_work;

static fb_stepper stepper;
static int iterations; /* 0: the default */

/* Steps first .. n - 1 of an integrator, *at being where they start. */
static fb_status integrate_on(fb_state *at, fb_integrator integrator, double step, int first, int n)
{
  static fb_input in[3];
  fb_status status = FB_OK;
  if (integrator == FB_INTEGRATOR_EXPONENTIAL) {
    status = fb_exponential_init(&exponential, &body_work, &body, (fb_real)step);
  }
  for (int k = first; k < n && status == FB_OK; k++) {
    for (int i = 0; i < 3; i++) {
      if (varies) {
        input_at(&in[i], (k + 0.5 * i) * step);
      } else {
        in[i] = input;
      }
    }
    switch (integrator) {
    case FB_INTEGRATOR_MIDPOINT:
      status = fb_midpoint_step(&body, at, &implicit, &in[1], (fb_real)step, iterations);
      break;
    case FB_INTEGRATOR_SDIRK:
      status = fb_sdirk_step(&body, at, &implicit, &in[0], &in[2], (fb_real)step, iterations);
      break;
    case FB_INTEGRATOR_EXPONENTIAL:
      status = fb_exponential_step(&body, &exponential, at, &exponential_work, &in[0], &in[1], &in[2]);
      break;
    default:
      status = fb_rk4_step(&body, at, &rk4, &in[0], &in[1], &in[2], (fb_real)step);
      break;
    }
  }
  return status;
}

/* n steps of an integrator from the start of the scene to *at. */
static fb_status integrate(fb_state *at, fb_integrator integrator, double step, int n)
{
  *at = state;
  return integrate_on(at, integrator, step, 0, n);
}

/* Difference of two ends of one scene at the time t, by its nodes. */
static double apart(const fb_state *a, const fb_state *b, double t)
{
  static look first, second;
  static fb_input in;
  in = input;
  if (varies) {
    input_at(&in, t);
  }
  if (look_at(&first, a, &in) != FB_OK || look_at(&second, b, &in) != FB_OK) {
    return HUGE_VAL;
  }
  return ends_differ(&first, &second);
}

/* Every integrator approaches what rk4 finds with its order: the deviation of the order that is seen, as far as
   rounding lets it be seen. */
static double orders(double h)
{
  static const struct {
    fb_integrator integrator;
    double order;
  } scheme[] = {{FB_INTEGRATOR_MIDPOINT, 2.0}, {FB_INTEGRATOR_SDIRK, 2.0}, {FB_INTEGRATOR_EXPONENTIAL, 4.0}};
  const int n = (int)(1.0 / h + 0.5);
  double step, worst = 0.0;
  fb_state exact;
  FBL_TRY(longest(&step, 1));
  varies = 1;
  FBL_TRY(integrate(&exact, FB_INTEGRATOR_RK4, 0.125 * h * step, 8 * n));
  for (int k = 0; k < FBL_COUNT(scheme); k++) {
    double error[2];
    for (int half = 0; half < 2; half++) {
      fb_state at;
      const fb_status status = integrate(&at, scheme[k].integrator, h * step / (1 << half), n << half);
      if (status == FB_ERR_STEP && scheme[k].integrator == FB_INTEGRATOR_EXPONENTIAL) { /* lines that bend far */
        error[half] = 0.0;
        continue;
      }
      FBL_TRY(status);
      error[half] = apart(&exact, &at, n * h * step);
    }
    if (error[1] > 1e-9) {
      worst = larger(worst, fabs(log(error[0] / error[1]) / log(2.0) - scheme[k].order));
    }
  }
  return worst;
}

/* The default number of iterations leaves less than the step itself errs by: the matrix of the implicit integrators is
   the derivative of the equations. */
static double iterations_suffice(double h)
{
  static const fb_integrator each[] = {FB_INTEGRATOR_MIDPOINT, FB_INTEGRATOR_SDIRK};
  double step, worst = 0.0;
  fb_state exact;
  (void)h; /* a matrix that is wrong matters in long steps */
  FBL_TRY(longest(&step, 1));
  step *= 0.6;
  FBL_TRY(integrate(&exact, FB_INTEGRATOR_RK4, 0.125 * step, 32));
  for (int k = 0; k < FBL_COUNT(each); k++) {
    fb_state few, many;
    const fb_status status = integrate(&few, each[k], step, 4);
    if (status == FB_ERR_CONVERGENCE) { /* it says so */
      continue;
    }
    FBL_TRY(status);
    iterations = 12;
    if (integrate(&many, each[k], step, 4) != FB_OK) {
      many = exact;
    }
    iterations = 0;
    worst = larger(worst, apart(&few, &many, 0.0) / (apart(&exact, &many, 0.0) + 1e-10));
  }
  return worst;
}

/* Near rest the equations are linear: what the default iterations leave of a long step falls with the square of the
   motion if the matrix of the implicit integrators is their derivative. */
static double small_steps(double h)
{
  static const fb_integrator each[] = {FB_INTEGRATOR_MIDPOINT, FB_INTEGRATOR_SDIRK};
  fbl_choice c = now;
  double step, miss = 0.0;
  c.gravity = FBL_NO_GRAVITY;
  c.rotors = c.rotors == FBL_RUBBING ? FBL_ON_BOOM : c.rotors; /* friction is none of the matrix */
  FBL_TRY(near_by(&c, load_level == DISTRIBUTED ? DEAD : load_level, 0, h));
  FBL_TRY(longest(&step, 0));
  for (int k = 0; k < FBL_COUNT(each); k++) {
    fb_state few, many;
    fb_status status;
    iterations = 15;
    status = integrate(&many, each[k], 4.0 * step, 2);
    iterations = 0;
    FBL_TRY(status);
    miss = larger(miss, integrate(&few, each[k], 4.0 * step, 2) == FB_OK ? apart(&few, &many, 0.0) / h : 1.0);
  }
  return miss;
}

/* One step that is as long as it is told of a scene as it is seen; *left: what the last iteration changed, of a step that did
   not converge. */
static fb_status step_as_seen(double *left, const fbl_view *view, fb_integrator integrator, double step)
{
  fb_state at;
  double need;
  fb_status status;
  fbl_seen = *view;
  status = fbl_draw_again();
  body.allow_long_step = 1;
  status = status ? status : integrate(&at, integrator, step, 1);
  (void)fbl_record(left, &need, 1.0);
  fbl_plain();
  return status;
}

/* What tells that a step has not converged does not depend on the attitude, but for the rounding that grows where iterations
   diverge. */
static double convergence(double h)
{
  static const fb_integrator each[] = {FB_INTEGRATOR_MIDPOINT, FB_INTEGRATOR_SDIRK};
  const fbl_view plain = fbl_seen;
  double step, miss = FBL_NONE;
  (void)h;
  FBL_TRY(longest(&step, 1));
  for (int k = 0; k < FBL_COUNT(each); k++) {
    for (int twice = 0; twice < 9; twice++) {
      double left[2];
      const fb_status status = step_as_seen(&left[0], &plain, each[k], step * (1 << twice));
      if (status == FB_ERR_CONVERGENCE) {
        miss = larger(miss, step_as_seen(&left[1], &fbl_turned, each[k], step * (1 << twice)) == status
                                ? fabs(left[1] - left[0]) / (left[0] + 1e-300)
                                : 1.0);
        break;
      }
    }
  }
  return miss;
}

/* A step that is longer than its limit is refused and leaves the state; one that is shorter is not refused for that.
   Faster rotors never allow longer steps at the same acceleration of O. */
static double limits(double h)
{
  fb_body_limit limit, slower = {FB_HUGE, FB_HUGE, FB_HUGE, FB_R(0.0), FB_R(0.0)};
  (void)h;
  for (int k = 0; k < 3; k++) {
    wheels = k;
    input_draw();
    fbl_stream("spin");
    FBL_TRY(state_draw());
    FBL_TRY(fb_body_limit_eval(&body, &limit, &state, &input));
    if (limit.acceleration >= slower.acceleration &&
        (limit.rk4 > slower.rk4 || limit.implicit > slower.implicit || limit.exponential > slower.exponential)) {
      return 1.0;
    }
    slower = limit;
  }
  /* of a base that is driven, which has no recoil, the matrix of the implicit integrators leaves out more than E11.10 */
  if (body.base == FB_BASE_PRESCRIBED && now.effects != FBL_STRAIN && !now.damping &&
      limit.exponential < limit.implicit) {
    return 1.0;
  }
  wheels = 1.0;
  input_draw();
  fbl_stream("spin");
  FBL_TRY(state_draw());
  FBL_TRY(fb_body_limit_eval(&body, &limit, &state, &input));
  for (int k = 0; k < FB_INTEGRATOR_COUNT; k++) {
    const double most = (double)(k == FB_INTEGRATOR_RK4           ? limit.rk4
                                 : k == FB_INTEGRATOR_EXPONENTIAL ? limit.exponential
                                                                  : limit.implicit);
    fb_state at;
    char what[160] = "";
    double have = 1.001, need = 1.0;
    if (most > 1e6 * (double)fbl_unit(1.0, 0, 0, 1)) {
      continue;
    }
    if (integrate(&at, (fb_integrator)k, 1.001 * most, 1) != FB_ERR_STEP || memcmp(&at, &state, sizeof at) != 0) {
      return 1.0;
    }
    (void)snprintf(what, sizeof what, "%s",
                   fbl_record(&have, &need, most)); /* less: what deflections change in modes */
    if (fabs(have - 1.001) > 1e-6 ||
        (fabs(need - 1.0) > 1e-9 && (need > 1.0 || k != FB_INTEGRATOR_EXPONENTIAL || now.effects != FBL_LARGE))) {
      return 1.0;
    }
    if (need > 0.9999 && integrate(&at, (fb_integrator)k, 0.999 * most, 1) == FB_ERR_STEP &&
        strcmp(what, fbl_record(&have, &need, most)) == 0) {
      return 1.0;
    }
  }
  return 0.0;
}

/* By how much steps of rk4 enlarge the motion near rest: speeds of the nodes, energy. HUGE_VAL: they were refused. */
static double growth(double step)
{
  static look first, second;
  double most[2] = {0.0, 0.0};
  fb_state at;
  if (look_at(&first, &state, &input) != FB_OK || integrate(&at, FB_INTEGRATOR_RK4, step, 80) != FB_OK ||
      look_at(&second, &at, &input) != FB_OK) {
    return HUGE_VAL;
  }
  for (int k = 0; k < body.n_node; k++) {
    most[0] = larger(most[0], fbl_largest(first.node[k].velocity, 3));
    most[1] = larger(most[1], fbl_largest(second.node[k].velocity, 3));
  }
  most[0] += sqrt((double)first.energy.strain / (double)body.mass); /* what stiffness makes of it */
  return larger(most[1] / most[0], ((double)second.energy.kinetic + (double)second.energy.strain) /
                                       ((double)first.energy.kinetic + (double)first.energy.strain));
}

/* Near rest steps of rk4 at the limit are stable, also under wheels that are fast, whose part of the limit is a bound; those
   a fifth longer are not, of damped modes 2.6 times as long (critical damping: 2.41). */
static double limits_hold(double h)
{
  fbl_choice c = now;
  double step;
  c.gravity = FBL_NO_GRAVITY;
  c.rotors = c.rotors >= FBL_RUBBING ? FBL_ON_BOOM : c.rotors; /* friction and the caller drive the motion */
  if (c.rotors) {
    wheels = (fbl_pick(2) ? 100.0 : 1.0) / h;
    FBL_TRY(near_by(&c, NO_LOAD, 0, h));
    wheels = 1.0;
    FBL_TRY(longest(&step, 0));
    if (growth(0.99 * step) > 100.0) {
      return 1.0;
    }
  }
  c.rotors = FBL_NO_ROTOR;
  FBL_TRY(near_by(&c, NO_LOAD, 0, h));
  FBL_TRY(longest(&step, 0));
  if (body.n > 0 && growth(0.99 * step) > 100.0) {
    return 1.0;
  }
  body.allow_long_step = 1;
  return body.n > 0 && step < 0.09 * (double)fbl_unit(1.0, 0, 0, 1) && growth((now.damping ? 2.6 : 1.2) * step) < 1e3
             ? 1.0
             : 0.0;
}

/* What is no number in a model is refused by its check, or nothing reads it; a bit that the check word does not see is one
   that changes nothing. */
static double words(double h)
{
  static fb_body other, own;
  static look first, second;
  const unsigned word = fb_body_crc(&body);
  (void)h;
  if (fb_body_check(&body) != FB_OK || fb_state_check(&body, &state) != FB_OK) {
    return 1.0;
  }
  FBL_TRY(look_at(&first, &state, &input));
  fbl_stream("words");
  own = body;
  for (int k = 0; k < 160; k++) {
    fb_status status;
    memcpy(&other, &own, sizeof other);
    (k < 60 ? fbl_spoil : fbl_flip)(&other, sizeof other);
    if (fb_body_check(&other) != FB_OK || (k >= 60 && fb_body_crc(&other) != word)) {
      continue;
    }
    body = other;
    status = look_at(&second, &state, &input);
    body = own;
    if (status || ends_differ(&first, &second) > 0.0) {
      return 1.0;
    }
  }
  return fb_body_crc(&body) == word ? 0.0 : 1.0;
}

/* States and inputs of a legal body that are wrong in one place. */
static int wrong_motions(void)
{
  static fb_motion motion;
  static fb_node_motion node;
  fb_state at = state, rate = state;
  fb_real v[3] = {0}, w[3] = {0};
  fb_real dt_ = FB_R(1e-6);
  int number = 0, many = 3, n = 0;
#define STATE(what, wrong, status) FBL_WRONG(n, what, wrong, status, fb_state_check(&body, &at), body)
  STATE(at.quat[0], FB_R(1.5), FB_ERR_VALUE);
  STATE(at.quat[3], FB_R(0.0), FB_ERR_VALUE);
  STATE(at.rho[1], FBL_NAN, FB_ERR_NOT_FINITE);
  STATE(at.L[2], (fb_real)HUGE_VAL, FB_ERR_NOT_FINITE);
  if (body.n > 0) {
    STATE(at.pi[0], FBL_NAN, FB_ERR_NOT_FINITE);
    STATE(at.q[body.n - 1], FBL_NAN, FB_ERR_NOT_FINITE);
  }
  if (body.base >= FB_BASE_PINNED) {
    STATE(at.u[0], FB_R(1.0), FB_ERR_VALUE);
    FBL_WRONG(n, v[1], FB_R(1.0), FB_ERR_VALUE, fb_state_from_velocity(&body, &at, v, w, NULL), at);
  }
  if (body.base == FB_BASE_HINGED) {
    FBL_WRONG(n, w[1], FB_R(1.0), FB_ERR_VALUE, fb_state_from_velocity(&body, &at, v, w, NULL), at);
  }
  FBL_WRONG(n, w[2], FBL_NAN, FB_ERR_NOT_FINITE, fb_state_from_velocity(&body, &at, v, w, NULL), at);
#undef STATE
#define INPUT(what, wrong, status)                                                                     \
  do {                                                                                                 \
    FBL_WRONG(n, what, wrong, status, fb_body_motion_eval(&body, &motion, &at, &input), motion);       \
    FBL_WRONG(n, what, wrong, status, fb_body_rates_eval(&body, &rate, &at, &input), rate);            \
    FBL_WRONG(n, what, wrong, status, fb_midpoint_step(&body, &at, &implicit, &input, dt_, many), at); \
  } while (0)
  INPUT(input.n_load, FB_MAX_LOADS + 1, FB_ERR_CAPACITY);
  INPUT(input.n_load, -1, FB_ERR_CAPACITY);
  if (input.n_load > 0) {
    fb_load *const load = &input.load[input.n_load - 1];
    INPUT(load->node, body.n_node, FB_ERR_CAPACITY);
    INPUT(load->node, -1, FB_ERR_CAPACITY);
    INPUT(load->axes, FB_AXES_COUNT, FB_ERR_VALUE);
    INPUT(load->force[0], FBL_NAN, FB_ERR_NOT_FINITE);
    INPUT(load->torque[2], FBL_NAN, FB_ERR_NOT_FINITE);
  }
  if (body.base == FB_BASE_PRESCRIBED) {
    INPUT(input.v[0], FBL_NAN, FB_ERR_NOT_FINITE);
    INPUT(input.w[2], FBL_NAN, FB_ERR_NOT_FINITE);
    FBL_WRONG(n, input.v_dot[1], FBL_NAN, FB_ERR_NOT_FINITE, fb_body_motion_eval(&body, &motion, &at, &input), motion);
  }
  if (now.effects != FBL_LARGE) {
    INPUT(input.distributed, fbl_wind, FB_ERR_UNSUPPORTED);
  }
  for (int r = 0; r < FB_MAX_ROTORS; r++) {
    INPUT(input.rotor[r].torque, FBL_NAN, r < body.n_rotor ? FB_ERR_NOT_FINITE : FB_ERR_VALUE);
    if (r >= body.n_rotor) {
      INPUT(input.rotor[r].torque, FB_R(1.0), FB_ERR_VALUE);
    }
    if (r >= body.n_rotor || !body.rotor[r].given) {
      INPUT(input.rotor[r].momentum, FB_R(1.0), FB_ERR_VALUE);
    } else {
      number = r;
      FBL_WRONG(n, at.rho[0], at.rho[0], FB_ERR_VALUE,
                fb_state_rotor_set(&body, &at, number, FB_R(1.0), FB_R(0.0), &input), at);
    }
  }
  FBL_WRONG(n, number, body.n_rotor, FB_ERR_CAPACITY,
            fb_state_rotor_set(&body, &at, number, FB_R(1.0), FB_R(0.0), &input), at);
#undef INPUT
  FBL_WRONG(n, number, body.n_node, FB_ERR_CAPACITY, fb_body_node_motion_eval(&body, &node, &at, &motion, number),
            node);
  FBL_WRONG(n, number, -1, FB_ERR_CAPACITY, fb_body_node_motion_eval(&body, &node, &at, &motion, number), node);
#define STEP(what, wrong)                                                                                         \
  do {                                                                                                            \
    FBL_WRONG(n, what, wrong, FB_ERR_VALUE, fb_midpoint_step(&body, &at, &implicit, &input, dt_, many), at);      \
    FBL_WRONG(n, what, wrong, FB_ERR_VALUE, fb_sdirk_step(&body, &at, &implicit, &input, &input, dt_, many), at); \
  } while (0)
  STEP(dt_, FB_R(0.0));
  STEP(dt_, FB_R(-1e-6));
  STEP(dt_, FBL_NAN);
  STEP(many, -1);
#undef STEP
  FBL_WRONG(n, dt_, FB_R(0.0), FB_ERR_VALUE, fb_rk4_step(&body, &at, &rk4, &input, &input, &input, dt_), at);
  FBL_WRONG(n, dt_, FBL_NAN, FB_ERR_VALUE, fb_exponential_init(&exponential, &body_work, &body, dt_), exponential);
  return n;
}

/* A model in memory that has changed is no legal one any more. */
static int wrong_memory(void)
{
  int n = fb_body_check(&body) != FB_OK;
  static fb_body other;
  other = body;
#define MEMORY(what, wrong) FBL_WRONG(n, what, wrong, FB_ERR_CAPACITY, fb_body_check(&other), body)
  MEMORY(other.n, FB_MAX_MODES + 1);
  MEMORY(other.n_node, 0);
  MEMORY(other.n_node, FB_MAX_NODES + 1);
  MEMORY(other.base, FB_BASE_COUNT);
  MEMORY(other.mass, FB_R(-1.0));
  MEMORY(other.deflection_limit, FB_R(-1.0));
  MEMORY(other.gyration, FB_R(-1.0));
  MEMORY(other.recoil, FB_R(-1.0));
  MEMORY(other.limit_elastic, FB_R(-1.0));
  MEMORY(other.limit_damping, FB_R(-1.0));
  MEMORY(other.limit_spin, FB_R(-1.0));
  MEMORY(other.limit_acceleration, FB_R(-1.0));
  if (other.n_S > 0) {
    fb_lambda_term *const last = &other.S[other.n_S - 1];
    MEMORY(last->i, 27);
    MEMORY(last->a, (unsigned char)(other.n + 1));
    MEMORY(last->b, (unsigned char)(last->a + 1));
    MEMORY(other.n_slope, other.n_S + 1);
  }
  if (other.n_rotor > 0) {
    MEMORY(other.rotor[0].node, other.n_node);
    MEMORY(other.rotor[0].inertia, FB_R(0.0));
  }
#undef MEMORY
  return n;
}

/* One wrong value in a legal scene is refused with the status of its kind, and changes nothing. */
static double wrong(double h)
{
  fb_motion motion;
  (void)h;
  FBL_TRY(fb_body_motion_eval(&body, &motion, &state, &input));
  return wrong_motions() + wrong_memory() + fbl_wrong_bodies(&now);
}

static void zero_lost(fb_state *at)
{
  memset(at->lost_rho, 0, sizeof at->lost_rho);
  memset(at->lost_u, 0, sizeof at->lost_u);
#if FB_SINGLE
  memset(at->lost_quat, 0, sizeof at->lost_quat);
  memset(at->lost_L, 0, sizeof at->lost_L);
  memset(at->lost_h, 0, sizeof at->lost_h);
  memset(at->lost_q, 0, sizeof at->lost_q);
  memset(at->lost_pi, 0, sizeof at->lost_pi);
#endif
}

static void reverse(fb_state *at)
{
  for (int i = 0; i < 3; i++) {
    at->u[i] = -at->u[i];
    at->L[i] = -at->L[i];
    at->h[i] = -at->h[i];
    input.v[i] = -input.v[i];
    input.w[i] = -input.w[i];
  }
  for (int a = 0; a < body.n_coordinate; a++) {
    at->pi[a] = -at->pi[a];
  }
  for (int r = 0; r < body.n_rotor; r++) {
    input.rotor[r].momentum = -input.rotor[r].momentum;
  }
  zero_lost(at);
}

/* A conservative motion whose momenta are reversed goes back to where it came from. */
static double goes_back(double h)
{
  double step;
  fb_state there, back;
  const fb_state start = state;
  if (now.damping || now.rotors == FBL_RUBBING || input.distributed) {
    return FBL_NONE;
  }
  FBL_TRY(longest(&step, 0));
  FBL_TRY(integrate(&there, FB_INTEGRATOR_RK4, h * step, 30));
  reverse(&there);
  state = there;
  FBL_TRY(integrate(&back, FB_INTEGRATOR_RK4, h * step, 30));
  reverse(&back);
  state = start;
  return apart(&start, &back, 0.0);
}

/* What work structs held before, a copy of the state half way, and a stepper that goes on from there, change no bit. */
static double same_bits(double h)
{
  double step;
  (void)h;
  FBL_TRY(longest(&step, 1));
  step *= 0.3;
  varies = 1;
  for (int k = 0; k < FB_INTEGRATOR_COUNT; k++) {
    fb_stepper_desc how;
    fb_input in[3];
    fb_state once, half, again;
    memset(&rk4, 0, sizeof rk4);
    memset(&implicit, 0, sizeof implicit);
    memset(&exponential_work, 0, sizeof exponential_work);
    memset(&body_work, 0, sizeof body_work);
    if (integrate(&once, (fb_integrator)k, step, 8) == FB_ERR_STEP && k == FB_INTEGRATOR_EXPONENTIAL) {
      continue; /* lines that bend far */
    }
    memset(&rk4, 0xa5, sizeof rk4);
    memset(&implicit, 0xa5, sizeof implicit);
    memset(&exponential_work, 0xa5, sizeof exponential_work);
    memset(&body_work, 0xa5, sizeof body_work);
    memset(&stepper, 0xa5, sizeof stepper);
    (void)integrate(&half, (fb_integrator)k, step, 4);
    again = half;
    memset(&how, 0, sizeof how);
    how.body = &body;
    how.state = &again;
    how.input = in;
    how.n_input = 3;
    how.integrator = (fb_integrator)k;
    how.exponential = k == FB_INTEGRATOR_EXPONENTIAL ? &exponential : NULL;
    how.dt = (fb_real)step;
    FBL_TRY(fb_stepper_init(&stepper, &how));
    for (int n = 4; n < 8; n++) {
      for (int i = 0; i < 3; i++) {
        input_at(&in[i], (n + 0.5 * i) * step);
      }
      FBL_TRY(fb_stepper_step(&stepper));
    }
    if (memcmp(&once, &again, sizeof once) != 0 || fabs((double)stepper.t / (4.0 * step) - 1.0) > 1e-6) {
      return 1.0;
    }
  }
  return 0.0;
}

/* An input that is absent is one that is zero, to the last bit, in status, too. */
static double absent(double h)
{
  static const fb_input zero;
  static fb_motion motion[2];
  static fb_momentum momentum[2];
  static fb_energy energy[2];
  static fb_state rate[2], at[2];
  fb_status status[2][5];
  double step;
  (void)h;
  FBL_TRY(longest(&step, 1));
  for (int k = 0; k < 2; k++) {
    const fb_input *const in = k ? &zero : NULL;
    memset(&motion[k], 0, sizeof motion[k]);
    memset(&momentum[k], 0, sizeof momentum[k]);
    memset(&energy[k], 0, sizeof energy[k]);
    memset(&rate[k], 0, sizeof rate[k]);
    at[k] = state;
    status[k][0] = fb_body_motion_eval(&body, &motion[k], &state, in);
    status[k][1] = fb_body_rates_eval(&body, &rate[k], &state, in);
    status[k][2] = fb_body_energy_eval(&body, &energy[k], &state, in);
    status[k][3] = fb_body_momentum_eval(&body, &momentum[k], &state, in);
    status[k][4] = fb_rk4_step(&body, &at[k], &rk4, in, in, in, (fb_real)(0.3 * step));
  }
  return memcmp(status[0], status[1], sizeof status[0]) != 0 || memcmp(&motion[0], &motion[1], sizeof motion[0]) != 0 ||
                 memcmp(&rate[0], &rate[1], sizeof rate[0]) != 0 ||
                 memcmp(&energy[0], &energy[1], sizeof energy[0]) != 0 ||
                 memcmp(&momentum[0], &momentum[1], sizeof momentum[0]) != 0 ||
                 memcmp(&at[0], &at[1], sizeof at[0]) != 0
             ? 1.0
             : 0.0;
}

/* The modes that were asked for are there. */
static double counts(double h)
{
  (void)h;
  return (double)abs(fbl_missing);
}

/* ---- laws: steady states, linear models */

static fb_analyse_work analyse;
static fb_linear linear;

/* Turns the start of the scene into a steady state; 0 if it has none. */
static int steady(void)
{
  if (now.effects == FBL_RIGID || now.rotors == FBL_RUBBING || now.rotors == FBL_UNBALANCED) {
    return 0;
  }
  if (body.base != FB_BASE_PRESCRIBED) { /* loads and gravity accelerate it */
    fbl_axial(input.w, 0.3, 0.5, 0.8, 0, 0, -1);
    if (body.base == FB_BASE_HINGED) {
      input.w[0] = input.w[1] = FB_R(0.0);
    }
    input.n_load = 0;
    input.distributed = NULL;
  }
  for (int r = 0; r < body.n_rotor; r++) {
    input.rotor[r].torque = FB_R(0.0);
  }
  return fb_body_trim(&body, &state, &analyse, &input) == FB_OK;
}

/* At a steady state nothing accelerates. */
static double equilibrium(double h)
{
  fb_motion motion;
  const double energy = (double)body.mass * (double)fbl_unit(size * size, 0, 2, -2);
  double miss = 0.0;
  (void)h;
  if (!steady()) {
    return FBL_NONE;
  }
  FBL_TRY(fb_body_motion_eval(&body, &motion, &state, &input));
  for (int a = 0; a < body.n; a++) {
    const double mass = body.unit_mass ? 1.0 : (double)body.M.diagonal[a], speed = sqrt(energy / mass);
    miss = larger(miss, fabs((double)motion.q_dot[a]) / speed);
    miss = larger(miss, fabs((double)motion.q_ddot[a]) / (speed * (double)fbl_unit(1.0, 0, 0, -1)));
  }
  return larger(miss, fbl_largest(motion.w_dot, 3) / (double)fbl_unit(1.0, 0, 0, -2));
}

/* What the outputs of the model are in the scene. */
static fb_status measure(double y[FB_MAX_PORTS], const fb_linear_desc *ports, const fb_state *at, const fb_input *in)
{
  fb_motion motion;
  fb_node_motion node;
  fb_imu imu;
  fb_real g[3];
  fb_status status = fb_body_motion_eval(&body, &motion, at, in);
  for (int k = 0; k < ports->n_out && status == FB_OK; k++) {
    const fb_port *const port = &ports->out[k];
    status = fb_body_node_motion_eval(&body, &node, at, &motion, port->node);
    status = status ? status : fb_body_gravity_eval(&body, g, node.position);
    fb_imu_eval(&imu, &node, g);
    y[k] = port->kind == FB_PORT_DISPLACEMENT   ? (double)node.displacement[port->axis]
           : port->kind == FB_PORT_ACCELERATION ? (double)imu.specific_force[port->axis]
                                                : (double)imu.angular_rate[port->axis];
  }
  return status;
}

/* A small force at a node moves the outputs as the linear model says: the difference is quadratic in the force. */
static double linear_response(double h)
{
  static const fb_linear_desc ports = {.n_in = 1,
                                       .n_out = 4,
                                       .in = {{.kind = FB_PORT_FORCE, .node = 1, .axis = 1}},
                                       .out = {{.kind = FB_PORT_DISPLACEMENT, .node = 1, .axis = 1},
                                               {.kind = FB_PORT_ACCELERATION, .node = 1, .axis = 1},
                                               {.kind = FB_PORT_ACCELERATION, .node = 0, .axis = 0},
                                               {.kind = FB_PORT_RATE, .node = 0, .axis = 2}}};
  enum { N = 6 };
  const double force = h * (double)fbl_unit(1.0, 1, 1, -2);
  double still[FB_MAX_PORTS], moved[FB_MAX_PORTS], y[FB_MAX_PORTS], step, miss = 0.0;
  fb_state at, same;
  fb_input plain;
  fb_load *load;
  if (now.gravity == FBL_GRAVITY || (now.gravity && body.base) || load_level == DEAD || load_level == DISTRIBUTED ||
      !steady()) {
    return FBL_NONE; /* directions that do not turn with the steady motion */
  }
  FBL_TRY(longest(&step, 0));
  FBL_TRY(fb_body_linearize(&body, &analyse, &linear, &state, &input, &ports));
  FBL_TRY(integrate(&same, FB_INTEGRATOR_RK4, 0.2 * step, N));
  plain = input;
  FBL_TRY(measure(still, &ports, &same, &input));
  load = &input.load[input.n_load++];
  memset(load, 0, sizeof *load);
  load->node = 1;
  load->axes = FB_AXES_BODY;
  load->force[1] = (fb_real)force;
  FBL_TRY(integrate(&at, FB_INTEGRATOR_RK4, 0.2 * step, N));
  FBL_TRY(measure(moved, &ports, &at, &input));
  input = plain;
  fbl_respond(y, &linear, 0, force, 0.2 * step, N);
  for (int k = 0; k < ports.n_out; k++) {
    const double unit = k == 0   ? (double)fbl_unit(0.05, 0, 1, 0)
                        : k == 3 ? (double)fbl_unit(0.1, 0, 0, -1)
                                 : (double)fbl_unit(0.1, 0, 1, -2);
    miss = larger(miss, fabs(moved[k] - still[k] - y[k]) / (fabs(y[k]) + h * unit));
  }
  return miss;
}

/* ---- what becomes of a model, to compare precisions by */

static fb_status digest(void)
{
  static look end;
  double step;
  fb_status status = longest(&step, 0);
  if (now.basis == FBL_SPUN) { /* fb_modes_desc.spin: single precision takes other modes where the spin is slow */
    return FB_ERR_UNSUPPORTED;
  }
  status = status ? status : motion_of(&end, fbl_step(0.3 * step));
  for (int k = 0; k < body.n_node - (now.effects != FBL_STRAIN) && status == FB_OK; k++) { /* not that near a root */
    for (int i = 0; i < 3; i++) {
      fbl_say((double)end.node[k].position[i], size);
    }
  }
  return status;
}

/* ---- the list */

static const fbl_law laws[] = {
    {"velocities_are_derivatives", "E8.20", velocities, 0.02, {1e-7, 3e-2}},
    {"loads_are_told_how_points_move", "E14.40", points, 0.02, {1e-7, 0}},
    {"accelerations_are_derivatives", "E8.19 E8.20 E8.44 E14.16", accelerations, 0.02, {1e-6, 0}},
    {"coordinates_and_their_rates", "E8.13 E8.19", coordinates, 0.02, {1e-6, 0}},
    {"angles_of_rotors", "E8.41", rotor_angles, 0.02, {1e-6, 0}},
    {"energy_changes_by_power", "E8.17 E8.44", energy_rate, 0.02, {1e-7, 0}},
    {"momentum_changes_by_force", "E8.17 E8.19", momentum_rates, 0.02, {1e-7, 0}},
    {"loads_at_roots_are_what_acts_on_lines", "E14.41", loads_at_roots, 0.02, {1e-6, 0}},
    {"boosted", "E8.13", boosted, 0.0, {1e-8, 0}},
    {"turned_and_shifted", "E8.13", turned_and_shifted, 0.0, {1e-9, 1e-2}},
    {"other_units", "E8.13", other_units, 0.0, {1e-9, 0}},
    {"factors_are_other_units", "E8.61", by_factors, 0.0, {1e-9, 0}},
    {"mirror_image", "E8.13", mirrored, 0.0, {1e-9, 1e-2}},
    {"order_of_parts_and_loads", "E8.13", reordered, 0.0, {1e-9, 1e-2}},
    {"plane_lines_are_lines", "E14.3 E14.5", plane_lines, 0.0, {1e-9, 0}},
    {"integrators_have_their_order", "E11.3 E11.7 E11.8 E11.10", orders, 0.25, {0.4, 0}},
    {"iterations_suffice", "E11.4 E11.25", iterations_suffice, 0.0, {0.1, 0}},
    {"long_steps_of_small_motions", "E11.4 E11.5 E11.25", small_steps, 1e-5, {1e-6, 0}},
    {"convergence_is_told_in_any_attitude", "E11.25 E11.32", convergence, 0.0, {1e-2, 0}},
    {"limits_of_steps", "E11.3 E11.6", limits, 0.0, {0.5, 0}},
    {"limits_hold", "E11.3 E11.6 E11.46", limits_hold, 1e-4, {0.5, 0}},
    {"models_and_their_check_words", "E8.11", words, 0.0, {0.5, 0}},
    {"what_is_wrong_is_refused", "E8.11 E11.3", wrong, 0.0, {0.5, 0.5}},
    {"motion_goes_back", "E8.17 E11.3", goes_back, 0.1, {1e-9, 0}},
    {"work_and_restart_change_no_bit", "E11.3 E11.8 E11.10", same_bits, 0.0, {0.5, 0.5}},
    {"what_is_absent_is_zero", "E8.17 E11.3", absent, 0.0, {0.5, 0.5}},
    {"modes_asked_for_are_there", "E7.3 E7.8", counts, 0.0, {0.5, 0.5}},
    {"steady_states_are_steady", "E12.1", equilibrium, 0.0, {1e-8, 1e-2}},
    {"linear_models_respond_as_the_body", "E12.2", linear_response, 0.01, {1e-4, 0}},
};

const fbl_kind fbl_body = {"body", features, FBL_COUNT(features), legal, draw, laws, FBL_COUNT(laws), digest};
