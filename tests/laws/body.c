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
static fb_state state; /* where the motion starts */
static fb_input input;
static double size;
static int now[FBL_FEATURES];

static void choose(fbl_choice *choice, const int *level)
{
  memcpy(choice, level, sizeof *choice);
}

static void legal(int *level)
{
  fbl_choice c;
  choose(&c, level);
  if (level[MOTION] == 2 && c.base != FB_BASE_FREE) {
    level[MOTION] = 1;
  }
  fbl_legal(&c);
  if (level[LOAD] == DISTRIBUTED && c.effects != FBL_LARGE) {
    level[LOAD] = DEAD;
  }
  memcpy(level, &c, sizeof c);
}

/* A dead load along the lines that grows towards their tips. */
static fb_status wind(fb_line_point *point, int n, fb_real t, void *user)
{
  fb_real along[3];
  (void)t, (void)user;
  fbl_inertial_polar(along, 0.2, -0.3, 0.4, 1, 0, -2);
  for (int k = 0; k < n; k++) {
    const double share = (double)point[k].length * (1.0 + (double)point[k].x / (double)fbl_unit(size, 0, 1, 0));
    for (int i = 0; i < 3; i++) {
      point[k].force[i] = (fb_real)(share * (double)along[i]);
    }
  }
  return FB_OK;
}

/* The node that the scene calls k, 0 the hub: beams in reverse order have their tips in reverse order. */
static int node_of(int k)
{
  return fbl_seen.reverse && now[7] == FBL_TWO_BEAMS && k > 0 && k <= 2 ? 3 - k : k;
}

static void load_draw(fb_load *load, int node, int axes, double force, double torque)
{
  const double f[3] = {fbl_in(-force, force), fbl_in(-force, force), fbl_in(-force, force)};
  const double t[3] = {fbl_in(-torque, torque), fbl_in(-torque, torque), fbl_in(-torque, torque)};
  load->node = node_of(node);
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
  if (now[LOAD] == DISTRIBUTED) {
    input.distributed = wind;
  } else if (now[LOAD] != NO_LOAD) {
    const int hub = now[LOAD] == ON_HUB, axes = now[LOAD] == DEAD ? FB_AXES_INERTIAL : FB_AXES_NODE;
    input.n_load = 2;
    for (int k = 0; k < 2; k++) {
      load_draw(&input.load[fbl_seen.reverse ? 1 - k : k], hub ? 0 : 1, hub && k ? FB_AXES_BODY : axes, 2.0, hub ? 2.0 : 0.3);
    }
  }
  fbl_stream("motor");
  for (int r = 0; r < body.n_rotor; r++) {
    const double sign = fbl_seen.mirror ? -1.0 : 1.0;
    const double torque = fbl_in(-0.05, 0.05), momentum = fbl_in(-2.0, 2.0);
    (void)sign; /* torque and momentum are about the axis, which is mirrored itself */
    input.rotor[r].torque = body.rotor[r].given ? FB_R(0.0) : fbl_unit(torque, 1, 2, -2);
    input.rotor[r].momentum = body.rotor[r].given ? fbl_unit(momentum, 1, 2, -1) : FB_R(0.0);
  }
}

static fb_status state_draw(void)
{
  static const double q[4] = {0.5, -0.5, 0.1, 0.7};
  const double fast = now[MOTION] == 0 ? 0.1 : 1.5, spin[3] = {fbl_in(-fast, fast), fbl_in(-fast, fast), fbl_in(-fast, fast)};
  fb_real v[3] = {0}, w[3] = {0}, q_dot[FB_MAX_MODES] = {0}, u[3];
  fb_status status = fb_state_init(&body, &state);
  fbl_quat(state.quat, q, 1);
  for (int i = 0; i < 3; i++) {
    state.rho[i] = fbl_unit(fbl_seen.shift[i], 0, 1, 0);
  }
  fbl_deflect(state.q, q_dot, &body, size);
  fbl_stream("velocity");
  if (body.base != FB_BASE_PINNED && body.base != FB_BASE_HINGED) {
    const double speed = now[MOTION] == 2 ? 400.0 : 0.3;
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
  status = status ? status : fb_state_from_velocity(&body, &state, v, w, q_dot);
  fbl_stream("wheels");
  for (int r = 0; r < body.n_rotor && status == FB_OK; r++) {
    const double speed = fbl_in(-60.0, 60.0), angle = fbl_in(-1.0, 1.0);
    if (!body.rotor[r].given) {
      status = fb_state_rotor_set(&body, &state, r, fbl_unit(speed, 0, 0, -1), (fb_real)(fbl_seen.mirror ? angle : angle), &input);
    }
  }
  fbl_inertial_polar(u, fbl_seen.boost[0], fbl_seen.boost[1], fbl_seen.boost[2], 0, 1, -1);
  for (int i = 0; i < 3 && body.base == FB_BASE_FREE; i++) {
    state.u[i] += u[i];
  }
  return status;
}

static fb_status draw(const int *level)
{
  fbl_choice choice;
  fb_status status;
  memcpy(now, level, sizeof now);
  choose(&choice, level);
  status = fbl_make(&body, &choice, &size);
  if (status != FB_OK) {
    return status;
  }
  input_draw();
  fbl_stream("spin");
  return state_draw();
}

/* ---- five states that follow each other, and all that can be asked of them */

typedef struct look {
  fb_state state;
  fb_motion motion;
  fb_node_motion node[FB_MAX_NODES];
  fb_energy energy;
  fb_momentum momentum;
} look;

static look path[5];
static double dt;

static fb_status look_at(look *at, const fb_state *where)
{
  fb_status status = fb_body_motion_eval(&body, &at->motion, where, &input);
  at->state = *where;
  for (int k = 0; k < body.n_node && status == FB_OK; k++) {
    status = fb_body_node_motion_eval(&body, &at->node[k], where, &at->motion, k);
  }
  status = status ? status : fb_body_energy_eval(&body, &at->energy, where, &input);
  return status ? status : fb_body_momentum_eval(&body, &at->momentum, where, &input);
}

/* h: in units of the longest step */
static fb_status walk(double h)
{
  static fb_rk4_work work;
  fb_body_limit limit;
  fb_state at = state;
  fb_status status = fb_body_limit_eval(&body, &limit, &state, &input);
  dt = h * ((double)limit.rk4 < 0.1 * (double)fbl_unit(1.0, 0, 0, 1) ? (double)limit.rk4 : 0.1 * (double)fbl_unit(1.0, 0, 0, 1));
  for (int k = 0; k < 5 && status == FB_OK; k++) {
    status = look_at(&path[k], &at);
    status = status || k == 4 ? status : fb_rk4_step(&body, &at, &work, &input, &input, &input, (fb_real)dt);
  }
  return status;
}

#define SLOPE(member) fbl_slope(&path[0].member, sizeof(look) / sizeof(fb_real), dt)

static double larger(double a, double b)
{
  return a > b ? a : b;
}

/* Rate of rotation by differences of quaternions, inertial axes: 2 q_dot conj(q). */
static void rotation_rate(double w[3], int node)
{
  double d[4], q[4];
  fb_real along[5];
  for (int i = 0; i < 4; i++) {
    for (int k = 0; k < 5; k++) {
      double cosine = 0.0;
      for (int j = 0; j < 4; j++) {
        cosine += (double)path[k].node[node].quat[j] * (double)path[2].node[node].quat[j];
      }
      along[k] = (fb_real)((cosine < 0.0 ? -1.0 : 1.0) * (double)path[k].node[node].quat[i]);
    }
    d[i] = fbl_slope(along, 1, dt);
    q[i] = (double)path[2].node[node].quat[i];
  }
  w[0] = 2.0 * (d[1] * q[0] - d[0] * q[1] - d[2] * q[3] + d[3] * q[2]);
  w[1] = 2.0 * (d[2] * q[0] - d[0] * q[2] - d[3] * q[1] + d[1] * q[3]);
  w[2] = 2.0 * (d[3] * q[0] - d[0] * q[3] - d[1] * q[2] + d[2] * q[1]);
}

/* ---- laws: derivatives */

/* Largest |difference| of derivatives from values, and the largest value, over the three axes. */
static double velocities(double h)
{
  double miss = 0.0;
  FBL_TRY(walk(h));
  for (int k = 0; k < body.n_node; k++) {
    double w[3], v_off = 0.0, w_off = 0.0;
    rotation_rate(w, k);
    for (int i = 0; i < 3; i++) {
      v_off = larger(v_off, fabs(SLOPE(node[k].position[i]) - (double)path[2].node[k].velocity[i]));
      w_off = larger(w_off, fabs(w[i] - (double)path[2].node[k].angular_rate[i]));
    }
    miss = larger(miss, v_off / (fbl_largest(path[2].node[k].velocity, 3) + 0.1 * (double)fbl_unit(size, 0, 1, -1)));
    miss = larger(miss, w_off / (fbl_largest(path[2].node[k].angular_rate, 3) + 0.1 * (double)fbl_unit(1.0, 0, 0, -1)));
  }
  return miss;
}

static double accelerations(double h)
{
  double miss = 0.0;
  FBL_TRY(walk(h));
  for (int k = 0; k < body.n_node; k++) {
    double a_off = 0.0, w_off = 0.0;
    for (int i = 0; i < 3; i++) {
      a_off = larger(a_off, fabs(SLOPE(node[k].velocity[i]) - (double)path[2].node[k].acceleration[i]));
      w_off = larger(w_off, fabs(SLOPE(node[k].angular_rate[i]) - (double)path[2].node[k].angular_acceleration[i]));
    }
    miss = larger(miss, a_off / (fbl_largest(path[2].node[k].acceleration, 3) + (double)fbl_unit(size, 0, 1, -2)));
    miss = larger(miss, w_off / (fbl_largest(path[2].node[k].angular_acceleration, 3) + (double)fbl_unit(1.0, 0, 0, -2)));
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

static double dot(const fb_real *a, const fb_real *b)
{
  return (double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] + (double)a[2] * (double)b[2];
}

static void to_inertial(fb_real *out, const fb_real quat[4], const fb_real *x)
{
  fb_real R[9];
  fb_quat_to_mat33(R, quat);
  fb_mat33_mul_vec3(out, R, x);
}

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
  if (now[9] == FBL_UNBALANCED) { /* loads that the model does not return */
    return FBL_NONE;
  }
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
    power += rotor_power(r);
    size_of += fabs(rotor_power(r));
  }
  if (input.distributed && body.n_rotor == 0 && now[10] != FBL_CENTER) {
    FBL_TRY(fb_body_lines_eval(&body, line, &n, &path[2].state, &path[2].motion, &input));
    for (int k = 0; k < n; k++) {
      power += dot(line[k].at.force, line[k].at.velocity);
      size_of += fabs(dot(line[k].at.force, line[k].at.velocity));
    }
  } else if (input.distributed) {
    return FBL_NONE;
  }
  power += dot(path[2].motion.reaction_force, path[2].motion.v) + dot(path[2].motion.reaction_torque, path[2].motion.w);
  return fabs(rate - power) / (size_of + (double)path[2].energy.kinetic * (double)fbl_unit(1.0, 0, 0, -1));
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
  if (now[9] == FBL_UNBALANCED || input.distributed || FB_SINGLE) {
    return FBL_NONE;
  }
  FBL_TRY(walk(h));
  to_inertial(f, path[2].state.quat, path[2].motion.reaction_force);
  to_inertial(t, path[2].state.quat, path[2].motion.reaction_torque);
  fb_vec3_cross(arm, path[2].state.rho, f);
  for (int i = 0; i < 3; i++) {
    force[i] = (double)f[i] + (body.effects & (FB_EFFECT_GRAVITY | FB_EFFECT_CENTRAL_GRAVITY) ? gravity_slope(i, 0) : 0.0);
    moment[i] = (double)t[i] + (double)arm[i] + (body.effects & (FB_EFFECT_GRAVITY | FB_EFFECT_CENTRAL_GRAVITY) ? gravity_slope(i, 1) : 0.0);
  }
  for (int k = 0; k < input.n_load; k++) {
    load_now(f, t, &input.load[k]);
    fb_vec3_cross(arm, path[2].node[input.load[k].node].position, f);
    for (int i = 0; i < 3; i++) {
      force[i] += (double)f[i];
      moment[i] += (double)t[i] + (double)arm[i];
    }
  }
  for (int i = 0; i < 3; i++) {
    f_size = larger(f_size, fabs(force[i]));
    m_size = larger(m_size, fabs(moment[i]));
  }
  f_size += (fbl_largest(path[2].momentum.linear, 3) + (double)fbl_unit(1.0, 1, 1, -1)) * (double)fbl_unit(1.0, 0, 0, -1);
  m_size += (fbl_largest(path[2].momentum.angular, 3) + (double)fbl_unit(1.0, 1, 2, -1)) * (double)fbl_unit(1.0, 0, 0, -1);
  for (int i = 0; i < 3; i++) {
    miss = larger(miss, fabs(SLOPE(momentum.linear[i]) - force[i]) / f_size);
    miss = larger(miss, fabs(SLOPE(momentum.angular[i]) - moment[i]) / m_size);
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
  return status ? status : look_at(end, &at);
}

/* Largest difference of the two ends over that of the motion itself, by nodes; the second is seen as fbl_seen has it. */
static double ends_differ(const look *a, const look *b)
{
  double miss = 0.0;
  const double length = (double)fbl_unit(size, 0, 1, 0), speed = (double)fbl_unit(size, 0, 1, -1);
  for (int k = 0; k < body.n_node; k++) {
    const fb_node_motion *const p = &a->node[k], *const q = &b->node[node_of(k)];
    fb_real x[3], v[3], acc[3], w[3], u[3];
    fbl_inertial_polar(x, (double)p->position[0], (double)p->position[1], (double)p->position[2], 0, 1, 0);
    fbl_inertial_polar(v, (double)p->velocity[0], (double)p->velocity[1], (double)p->velocity[2], 0, 1, -1);
    fbl_inertial_polar(acc, (double)p->acceleration[0], (double)p->acceleration[1], (double)p->acceleration[2], 0, 1, -2);
    fbl_inertial_axial(w, (double)p->angular_rate[0], (double)p->angular_rate[1], (double)p->angular_rate[2], 0, 0, -1);
    fbl_polar(u, (double)p->displacement[0], (double)p->displacement[1], (double)p->displacement[2], 0, 1, 0);
    for (int i = 0; i < 3; i++) {
      const double shift = (double)fbl_unit(fbl_seen.shift[i], 0, 1, 0);
      miss = larger(miss, fabs((double)q->position[i] - (double)x[i] - shift) / length);
    }
    miss = larger(miss, fbl_difference(q->velocity, v, 3) / (speed + fbl_largest(v, 3)));
    miss = larger(miss, fbl_difference(q->acceleration, acc, 3) / ((double)fbl_unit(size, 0, 1, -2) + fbl_largest(acc, 3)));
    miss = larger(miss, fbl_difference(q->angular_rate, w, 3) / ((double)fbl_unit(1.0, 0, 0, -1) + fbl_largest(w, 3)));
    miss = larger(miss, fbl_difference(q->displacement, u, 3) / length);
  }
  miss = larger(miss, fabs((double)b->energy.strain - (double)fbl_unit((double)a->energy.strain, 1, 2, -2)) /
                          ((double)fbl_unit((double)a->energy.kinetic + (double)a->energy.strain, 1, 2, -2) + 1e-300));
  return miss;
}

/* The scene as it is, then as `view` has it. */
static double seen_as(const fbl_view *view)
{
  static look first, second;
  fb_body_limit limit;
  double step, miss;
  fbl_plain();
  fbl_seen.undeformed = view->undeformed;
  FBL_TRY(fbl_draw_again());
  FBL_TRY(fb_body_limit_eval(&body, &limit, &state, &input));
  step = 0.3 * larger(0.0, (double)limit.rk4 < 0.1 ? (double)limit.rk4 : 0.1);
  FBL_TRY(motion_of(&first, step));
  fbl_seen = *view;
  FBL_TRY(fbl_draw_again());
  FBL_TRY(motion_of(&second, step * view->s));
  miss = ends_differ(&first, &second);
  fbl_plain();
  return miss;
}

static double turned_and_shifted(double h)
{
  static const fbl_view view = {1.0, 1.0, 1.0, 0, 0, 0, {0.1, 0.7, -0.5, 0.5}, {3.0, -2.0, 5.0}, {0.0, 0.0, 0.0}};
  (void)h;
  return seen_as(&view);
}

static double other_units(double h)
{
  static const fbl_view view = {4.0, 0.5, 8.0, 0, 0, 0, {1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  (void)h;
  return seen_as(&view);
}

static double mirrored(double h)
{
  static const fbl_view view = {1.0, 1.0, 1.0, 1, 0, 1, {1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  (void)h;
  return seen_as(&view);
}

static double reordered(double h)
{
  static const fbl_view view = {1.0, 1.0, 1.0, 0, 1, 1, {1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  (void)h;
  return now[7] == FBL_TWO_BEAMS || input.n_load > 1 ? seen_as(&view) : FBL_NONE;
}

/* ---- the list */

static const fbl_law laws[] = {
    {"velocities_are_derivatives", "E8.20", velocities, 0.02, {1e-7, 3e-2}},
    {"accelerations_are_derivatives", "E8.19 E8.20 E8.44 E14.16", accelerations, 0.02, {1e-6, 0}},
    {"coordinates_and_their_rates", "E8.13 E8.19", coordinates, 0.02, {1e-6, 0}},
    {"angles_of_rotors", "E8.41", rotor_angles, 0.02, {1e-6, 0}},
    {"energy_changes_by_power", "E8.17 E8.44", energy_rate, 0.02, {1e-7, 0}},
    {"momentum_changes_by_force", "E8.17 E8.19", momentum_rates, 0.02, {1e-7, 0}},
    {"turned_and_shifted", "E8.13", turned_and_shifted, 0.0, {1e-10, 1e-3}},
    {"other_units", "E8.13", other_units, 0.0, {1e-10, 1e-3}},
    {"mirror_image", "E8.13", mirrored, 0.0, {1e-9, 1e-3}},
    {"order_of_parts_and_loads", "E8.13", reordered, 0.0, {1e-10, 1e-3}},
};

const fbl_kind fbl_body = {"body", features, FBL_COUNT(features), legal, draw, laws, FBL_COUNT(laws), NULL};
