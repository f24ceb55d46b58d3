/* >>trim and >>linear: linear models of the exact beam; what is refused of it. */
#include "exact.h"

/* ---- linear models */

static fb_exact_linear linear;
static fb_exact_linear_work linear_work;
static fb_linear_desc ports;
static fb_exact_state steady;

static void port(fb_port *list, int *n, fb_port_kind kind, int at, int axis, fb_axes axes)
{
  fb_port *const p = &list[(*n)++];
  p->kind = kind;
  p->node = at;
  p->axis = axis;
  p->axes = axes;
}

/* Beams about whose steady states motion is small: clamped and straight, thinner at its tip; such a one spinning, set
   at an angle, pulled, with bodies on it; a shaft that whirls; a column under a follower load below flutter. Inputs and
   outputs of every kind. */
static void linear_case(int which, int n)
{
  const double stiffness[4][6] = {{1e4, 3e3, 3e3, 2.0, 5.0, 7.0},
                                  {1e4, 0.0, 0.0, 1.0, 1.0, 4.0},
                                  {1e4, 0.0, 0.0, 3.0, 1.0, 1.0},
                                  {1e4, 0.0, 0.0, 2.0, 3.0, 1.0}};
  const double inertia[4][6] = {{2.0, 2.0, 2.0, 0.02, 0.01, 0.01},
                                {1.0, 1.0, 1.0, 0.01, 0.002, 0.008},
                                {1.0, 1.0, 1.0, 0.02, 0.01, 0.01},
                                {1.0, 1.0, 1.0, 0.01, 0.005, 0.005}};
  beam(which == 0 ? 2.0 : 1.0, n, stiffness[which], inertia[which]);
  for (int i = 0; i < 6 && which < 2; i++) {
    desc.damping[i] = (fb_real)(which ? 2e-4 * (1 + i) : 1e-3);
  }
  if (which < 2) {
    desc.n_station = 2;
    desc.station[1] = desc.station[0];
    desc.station[1].x = desc.length;
    for (int i = 0; i < 36; i++) {
      desc.station[1].stiffness[i] *= FB_R(0.8);
    }
  }
  if (which == 1) {
    desc.attitude[0] = FB_R(0.9);
    desc.attitude[1] = FB_R(0.3);
    desc.position[0] = FB_R(0.2);
    input.w[2] = FB_R(12.0);
    desc.n_lump = 2;
    for (int l = 0; l < 2; l++) {
      desc.lump[l].node = l ? n : n / 2;
      desc.lump[l].mass = FB_R(0.05);
      desc.lump[l].center[1] = FB_R(0.02);
      desc.lump[l].inertia[0] = desc.lump[l].inertia[1] = desc.lump[l].inertia[2] = FB_R(0.001);
    }
    load_tip(FB_AXES_NODE, 5.0, 0.0, 1.0);
  } else if (which == 2) {
    desc.root = FB_END_PINNED | FB_HOLD_RX;
    desc.tip = FB_HOLD_Y | FB_HOLD_Z;
    input.w[0] = FB_R(5.0);
  } else if (which == 3) {
    load_tip(FB_AXES_NODE, -15.0, 0.3, 0.0);
  }
  settle();
  steady = state;
  memset(&ports, 0, sizeof ports);
  for (int axis = 0; axis < 3; axis++) {
    port(ports.in, &ports.n_in, FB_PORT_FORCE, n - 3, axis,
         axis != 1                             ? FB_AXES_NODE
         : input.w[0] + input.w[2] > FB_R(0.0) ? FB_AXES_BODY
                                               : FB_AXES_INERTIAL);
    port(ports.in, &ports.n_in, FB_PORT_TORQUE, n - 1, axis, axis == 1 ? FB_AXES_NODE : FB_AXES_BODY);
    port(ports.in, &ports.n_in, FB_PORT_BASE_RATE, 0, axis, FB_AXES_INERTIAL);
    port(ports.out, &ports.n_out, FB_PORT_DISPLACEMENT, n / 2, axis, FB_AXES_INERTIAL);
  }
  port(ports.in, &ports.n_in, FB_PORT_BASE_VELOCITY, 0, 1, FB_AXES_INERTIAL);
  port(ports.out, &ports.n_out, FB_PORT_ROTATION, n, 0, FB_AXES_INERTIAL);
  port(ports.out, &ports.n_out, FB_PORT_ROTATION, n, 2, FB_AXES_INERTIAL);
  port(ports.out, &ports.n_out, FB_PORT_VELOCITY, n / 3, 1, FB_AXES_INERTIAL);
  port(ports.out, &ports.n_out, FB_PORT_RATE, n - 2, 1, FB_AXES_INERTIAL);
  /* loads and strains along every axis in some case */
  port(ports.out, &ports.n_out, FB_PORT_INTERNAL_FORCE, 2, (1 + which) % 3, FB_AXES_INERTIAL);
  port(ports.out, &ports.n_out, FB_PORT_INTERNAL_MOMENT, 3, (2 + which) % 3, FB_AXES_INERTIAL);
  port(ports.out, &ports.n_out, FB_PORT_FORCE_STRAIN, 3, which % 3, FB_AXES_INERTIAL);
  port(ports.out, &ports.n_out, FB_PORT_MOMENT_STRAIN, n - 4, (1 + which) % 3, FB_AXES_INERTIAL);
}

/* What the output reads of the state. */
static double port_value(const fb_port *p, const fb_exact_state *of)
{
  fb_exact_element e;
  const fb_real *const q = steady.quat + 4 * p->node, back[4] = {q[0], -q[1], -q[2], -q[3]};
  fb_real turn[4], phi[3];
  FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, of), FB_OK);
  FBT_INT_EQ(fb_exact_element_eval(&exact, &e, of, p->node < exact.n ? p->node : 0), FB_OK);
  fb_quat_mul(turn, back, of->quat + 4 * p->node);
  fb_quat_to_rotvec(phi, turn);
  switch (p->kind) {
  case FB_PORT_DISPLACEMENT:
    return (double)node[p->node].displacement[p->axis];
  case FB_PORT_ROTATION:
    return (double)phi[p->axis];
  case FB_PORT_VELOCITY:
    return (double)node[p->node].velocity[p->axis];
  case FB_PORT_RATE:
    return (double)node[p->node].angular_rate[p->axis];
  case FB_PORT_INTERNAL_FORCE:
    return (double)e.force[p->axis];
  case FB_PORT_INTERNAL_MOMENT:
    return (double)e.moment[p->axis];
  case FB_PORT_FORCE_STRAIN:
    return (double)e.force_strain[p->axis];
  default:
    return (double)e.moment_strain[p->axis];
  }
}

static int moves_support(const fb_port *p)
{
  return p->kind == FB_PORT_SUPPORT_DISPLACEMENT || p->kind == FB_PORT_SUPPORT_ROTATION;
}

/* The input moved by h. */
static void port_drive(fb_exact_input *moved, const fb_port *p, double h)
{
  *moved = input;
  if (moves_support(p)) {
    fb_support_place *const place = &moved->support[moved->n_support++];
    memset(place, 0, sizeof *place);
    place->node = p->node;
    (p->kind == FB_PORT_SUPPORT_ROTATION ? place->rotation : place->displacement)[p->axis] = (fb_real)h;
  } else if (p->kind == FB_PORT_BASE_VELOCITY || p->kind == FB_PORT_BASE_RATE) {
    (p->kind == FB_PORT_BASE_RATE ? moved->w : moved->v)[p->axis] += (fb_real)h;
  } else {
    fb_load *const load = &moved->load[moved->n_load++];
    memset(load, 0, sizeof *load);
    load->node = p->node;
    load->axes = p->axes;
    (p->kind == FB_PORT_FORCE ? load->force : load->torque)[p->axis] = (fb_real)h;
  }
}

/* y = (C (s - A)^-1 B + D) u at s = i omega, by the blocks of the modes. */
static void linear_response(double y[2], int out, int in, double omega)
{
  y[0] = (double)linear.D[out * linear.n_in + in];
  y[1] = 0.0;
  for (int k = 0, at = 0; k < linear.n_mode; k++) {
    const double re = (double)linear.A[at * linear.n + at], b = (double)linear.B[at * linear.n_in + in];
    const double c = (double)linear.C[out * linear.n + at];
    if (linear.im[k] > FB_R(0.0)) {
      const double im = (double)linear.A[(at + 1) * linear.n + at], b2 = (double)linear.B[(at + 1) * linear.n_in + in];
      const double c2 = (double)linear.C[out * linear.n + at + 1];
      /* (s - A)^-1 = [s - re, -im; im, s - re] / ((s - re)^2 + im^2) */
      const double p = re * re - omega * omega + im * im, q = -2.0 * re * omega, size = p * p + q * q;
      const double top = -re * (c * b + c2 * b2) + im * (c2 * b - c * b2), side = omega * (c * b + c2 * b2);
      y[0] += (top * p + side * q) / size;
      y[1] += (side * p - top * q) / size;
      at += 2;
    } else {
      y[0] += c * b * -re / (re * re + omega * omega);
      y[1] -= c * b * omega / (re * re + omega * omega);
      at++;
    }
  }
}

/* Answers at rest to an input against differences of steady states. */
static void compare_rest(double *largest, int i)
{
  const fb_port *const in = &ports.in[i];
  const double h = (in->kind == FB_PORT_BASE_RATE || moves_support(in) ? 1e-3 : 1e-2) * FBT_TOL(1.0, 10.0);
  const double weight[4] = {1.0 / 12.0, -2.0 / 3.0, 2.0 / 3.0, -1.0 / 12.0};
  double want[FB_MAX_PORTS] = {0.0}, most = 0.0;
  for (int step = 0; step < 4; step++) {
    static fb_exact_input moved;
    port_drive(&moved, in, h * (step < 2 ? step - 2 : step - 1));
    state = steady;
    FBT_INT_EQ(fb_exact_trim(&exact, &state, &work, &moved), FB_OK);
    for (int o = 0; o < ports.n_out; o++) {
      want[o] += weight[step] / h * port_value(&ports.out[o], &state);
    }
  }
  for (int o = 0; o < ports.n_out; o++) {
    most = fmax(most, fabs(want[o]));
  }
  for (int o = 0; o < ports.n_out; o++) {
    double y[2];
    linear_response(y, o, i, 0.0);
    if (fabs(want[o]) > 1e-3 * most) {
      *largest = fmax(*largest, fabs(y[0] / want[o] - 1.0));
    }
    FBT_NEAR_ABS(y[0], want[o], FBT_TOL(1e-6 * fabs(want[o]) + 1e-9 * most + 1e-14, 1e-1 * most + 1e-6));
  }
}

/* E12.13, E12.15: at rest the linear model answers as fb_exact_trim does to small changes of every input, with
   any number of modes; its eigenvalues are those of the spectrum, and of A. */
TEST(linear_beams_rest_where_the_beam_does)
{
  double largest = 0.0;
  for (int which = 0; which < 4; which += FBT_LONG(1, 3)) {
    linear_case(which, 12);
    if (which == 1) { /* a dead load on what spins: as it stands at this instant */
      load_tip(FB_AXES_INERTIAL, 0.0, 0.5, 0.0);
      settle();
      steady = state;
    }
    for (int count = 1; count <= 12; count += 11) {
      FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &steady, &input, &ports, count), FB_OK);
      state = steady;
      spectrum_of(count);
      FBT_TRUE(linear.n_mode >= count && linear.n_mode <= count + 1 && linear.n <= 2 * linear.n_mode);
      FBT_TRUE(memcmp(linear.re, spectrum.re, (size_t)count * sizeof(fb_real)) == 0);
      FBT_TRUE(memcmp(linear.im, spectrum.im, (size_t)count * sizeof(fb_real)) == 0);
      FBT_NEAR_ABS(fb_spectrum_margin(NULL, linear.re, count), fb_spectrum_margin(NULL, spectrum.re, count), 0.0);
      for (int i = 0; i < ports.n_in; i++) {
        compare_rest(&largest, i);
      }
    }
  }
  fbt_figure("linear model of the exact beam, answers at rest", "differences of steady states", largest);
}

/* E12.15: the linear model of a beam follows the unit of time: of a heavier one, slower by 2^-12, the eigenvalues are
   as much less, each mode is a pair all the same, and the answer at rest is the same. */
TEST(linear_beams_follow_the_unit_of_time)
{
  double re[3], im[3], rest[2][2];
  for (int slow = 0; slow < 2; slow++) {
    const double t = slow ? 4096.0 : 1.0, m = 2.0 * t * t;
    const double stiffness[6] = {1e4, 3e3, 3e3, 20.0, 5.0, 7.0}, inertia[6] = {m, m, m, 0.02 * m, 0.01 * m, 0.01 * m};
    beam(2.0, 8, stiffness, inertia);
    load_tip(FB_AXES_INERTIAL, 0.1, 0.3, 0.2);
    input.w[2] = (fb_real)(0.5 / t);
    settle();
    memset(&ports, 0, sizeof ports);
    port(ports.in, &ports.n_in, FB_PORT_FORCE, 8, 1, FB_AXES_BODY);
    port(ports.in, &ports.n_in, FB_PORT_TORQUE, 4, 2, FB_AXES_BODY);
    port(ports.out, &ports.n_out, FB_PORT_DISPLACEMENT, 8, 1, FB_AXES_INERTIAL);
    FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &state, &input, &ports, 3), FB_OK);
    FBT_INT_EQ(linear.n, 6);
    for (int k = 0; k < 3; k++) {
      re[k] = slow ? re[k] : (double)linear.re[k];
      im[k] = slow ? im[k] : (double)linear.im[k];
      FBT_ZERO((double)linear.re[k] * t - re[k], im[k], FBT_TOL(1e-9, 1e-2));
      FBT_NEAR_REL((double)linear.im[k] * t, im[k], FBT_TOL(1e-9, 1e-2));
    }
    for (int i = 0; i < 2; i++) {
      double y[2];
      linear_response(y, 0, i, 0.0);
      rest[slow][i] = y[0];
      FBT_NEAR_REL(rest[slow][i], rest[0][i], FBT_TOL(1e-7, 2e-2));
    }
  }
}

/* E12.15: those are equal that lie closer than a part in 1e5, which the square root of the stiffnesses' ratio is. */
TEST(frequencies_are_equal_to_a_part_in_a_hundred_thousand)
{
  const double limit = FBT_TOL(1e-5, 1e-2), apart[2] = {0.8, 1.25};
  for (int k = 0; k < 2; k++) {
    const double stiffness[6] = {0.0, 0.0, 0.0, 0.0, 5.0, 5.0 * (1.0 + 2.0 * limit * apart[k])};
    const double inertia[6] = {2.0, 2.0, 2.0, 0.0, 0.0, 0.0};
    beam(2.0, 8, stiffness, inertia);
    settle();
    memset(&ports, 0, sizeof ports);
    FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &state, &input, &ports, 1), FB_OK);
    FBT_INT_EQ(linear.n_mode, k ? 1 : 2);
  }
}

/* E12.15: modes of equal frequency are kept together: a beam that bends alike in both planes answers alike in both, and
   across not at all, though one mode is asked for. */
TEST(equal_frequencies_are_kept_together)
{
  const double stiffness[6] = {1e4, 3e3, 3e3, 20.0, 5.0, 5.0}, inertia[6] = {2.0, 2.0, 2.0, 0.02, 0.01, 0.01};
  beam(2.0, 8, stiffness, inertia);
  settle();
  memset(&ports, 0, sizeof ports);
  for (int axis = 1; axis <= 2; axis++) {
    port(ports.in, &ports.n_in, FB_PORT_FORCE, 8, axis, FB_AXES_INERTIAL);
    port(ports.out, &ports.n_out, FB_PORT_DISPLACEMENT, 8, axis, FB_AXES_INERTIAL);
  }
  FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &state, &input, &ports, 1), FB_OK);
  FBT_INT_EQ(linear.n_mode, 2);
  for (int k = 0; k < 4; k++) { /* up to close below their frequency */
    double y[2], z[2], across[2];
    const double omega = 0.3 * k * (double)linear.im[0];
    linear_response(y, 0, 0, omega);
    linear_response(z, 1, 1, omega);
    linear_response(across, 0, 1, omega);
    FBT_NEAR_REL(y[0], z[0], FBT_TOL(1e-7, 1e-2));
    FBT_NEAR_ABS(across[0] / z[0], 0.0, FBT_TOL(1e-7, 1e-2));
  }
}

/* Middle of a step of x' = A x + B u by the midpoint rule, (1 - dt/2 A) middle = x + dt/2 B u; x goes on. */
static void linear_step(double *middle, double *x, int in, double u, double dt)
{
  for (int k = 0, at = 0; k < linear.n_mode; k++) {
    const int pair = linear.im[k] > FB_R(0.0);
    const double p = 1.0 - 0.5 * dt * (double)linear.re[k], q = 0.5 * dt * (double)linear.im[k];
    const double a = x[at] + 0.5 * dt * u * (double)linear.B[at * linear.n_in + in];
    const double b = pair ? x[at + 1] + 0.5 * dt * u * (double)linear.B[(at + 1) * linear.n_in + in] : 0.0;
    middle[at] = (p * a - q * b) / (p * p + q * q);
    if (pair) {
      middle[at + 1] = (p * b + q * a) / (p * p + q * q);
    }
    at += 1 + pair;
  }
  for (int k = 0; k < linear.n; k++) {
    x[k] = 2.0 * middle[k] - x[k];
  }
}

/* Largest difference of model and beam in each output, and the largest output, after a push u(t) = sin^4 half a period
   of the third mode long and as long again: both by the midpoint rule; half the difference of a push and its
   opposite. Of a support the middle of a step has the mean of its places. */
static void compare_push(double worst[FB_MAX_PORTS], double most[FB_MAX_PORTS], int in)
{
  static fb_exact_state both[2];
  static fb_exact_input moved;
  const int place = moves_support(&ports.in[in]);
  const double size = (ports.in[in].kind == FB_PORT_BASE_RATE ? 1e-4 : 1e-3) * FBT_TOL(1.0, place ? 20.0 : 300.0);
  const double length = pi / (double)linear.im[2], dt = length / 48.0;
  double x[FB_EXACT_STATES] = {0.0};
  both[0] = both[1] = steady;
  for (int step = 0; step < 96; step++) {
    const double t = (step + 0.5) * dt, after = t + 0.5 * dt;
    const double end = after < length ? pow(sin(pi * after / length), 4.0) : 0.0;
    const double start_of = t < length ? pow(sin(pi * (t - 0.5 * dt) / length), 4.0) : 0.0;
    const double u[2] = {place ? 0.5 * (start_of + end) : t < length ? pow(sin(pi * t / length), 4.0) : 0.0, end};
    double middle[FB_EXACT_STATES];
    linear_step(middle, x, in, u[0], dt);
    for (int way = 0; way < 2; way++) {
      port_drive(&moved, &ports.in[in], (way ? -size : size) * u[place]);
      FBT_INT_EQ(fb_exact_step(&exact, &both[way], &work, &moved, (fb_real)dt), FB_OK);
    }
    for (int o = 0; o < ports.n_out; o++) { /* poses are those after the step, all else that of its middle */
      const int pose = ports.out[o].kind <= FB_PORT_ROTATION;
      const double y = 0.5 / size * (port_value(&ports.out[o], &both[0]) - port_value(&ports.out[o], &both[1]));
      double model = (double)linear.D[o * linear.n_in + in] * u[pose];
      for (int k = 0; k < linear.n; k++) {
        model += (double)linear.C[o * linear.n + k] * (pose ? x[k] : middle[k]);
      }
      worst[o] = fmax(worst[o], fabs(y - model));
      most[o] = fmax(most[o], fabs(y));
    }
  }
}

/* E12.14, E12.15, E10.29: pushed by each input, the linear model with all modes of four elements moves as fb_exact_step
   moves the beam, damped or not: both by the middle of the step, so that little of the step's own error is left. */
TEST(linear_beams_move_as_the_beam_does)
{
  double largest[2] = {0.0, 0.0};
  for (int which = 0; which < 4; which++) {
    double worst[2][FB_MAX_PORTS] = {{0.0}}, most[2][FB_MAX_PORTS] = {{0.0}};
    linear_case(which, FBT_TOL(4, 12));
    FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &steady, &input, &ports, FBT_TOL(24, 12)), FB_OK);
    for (int i = 0; i < ports.n_in; i++) {
      const int base = ports.in[i].kind > FB_PORT_TORQUE;
      compare_push(worst[base], most[base], i);
    }
    for (int base = 0; base < 2; base++) {
      for (int o = 0; o < ports.n_out; o++) {
        if (most[base][o] > FBT_TOL(1e-6, 1e-3)) { /* else the output does not see it */
          largest[base] = fmax(largest[base], worst[base][o] / most[base][o]);
        }
      }
    }
  }
  FBT_BELOW(largest[0], FBT_TOL(4e-3, 0.2));
  FBT_BELOW(largest[1], FBT_TOL(4e-3, 0.2));
  fbt_figure("linear model of four elements with all its modes, pushed by loads", "fb_exact_step", largest[0]);
  fbt_figure("the same, its base moved", "fb_exact_step", largest[1]);
}

/* E12.13, E12.14, E12.15, E10.30: supports that move are inputs: the answer at rest is that of fb_exact_trim, that in time that
   of fb_exact_step, with all modes of four elements. Held at both ends, bent and damped (strains: loads of dampers follow the
   rate of the input); between them, by one direction aslant in the base; at the tip of what spins, whose root slides. */
TEST(moved_supports_are_inputs_of_linear_beams)
{
  const double stiffness[6] = {1e4, 3e3, 3e3, 20.0, 50.0, 70.0}, inertia[6] = {2.0, 2.0, 2.0, 0.02, 0.01, 0.01};
  static const int all[3] = {18, 23, 22};
  double rest = 0.0, largest = 0.0;
  for (int which = 0; which < 3; which++) {
    const int n = 4, at = which == 1 ? 2 : 4;
    double worst[FB_MAX_PORTS] = {0.0}, most[FB_MAX_PORTS] = {0.0};
    beam(2.0, n, stiffness, inertia);
    desc.attitude[0] = FB_R(0.9);
    desc.attitude[1] = FB_R(0.3);
    for (int i = 0; i < 6; i++) {
      desc.damping[i] = which ? FB_R(0.0) : FB_R(1e-3);
    }
    desc.tip = which == 0 ? FB_END_CLAMPED : which == 2 ? FB_HOLD_Y | FB_HOLD_Z | FB_HOLD_X : FB_END_FREE;
    desc.root = which == 2 ? FB_END_CLAMPED & ~FB_HOLD_X : FB_END_CLAMPED;
    if (which == 1) {
      desc.n_support = 1;
      desc.support[0].node = at;
      desc.support[0].held = FB_HOLD_Y;
    }
    input.w[0] = which == 2 ? FB_R(3.0) : FB_R(0.0);
    input.n_load = 1;
    input.load[0].node = n - 1;
    input.load[0].axes = FB_AXES_BODY;
    input.load[0].force[1] = FB_R(8.0);
    input.load[0].force[2] = FB_R(3.0);
    settle();
    steady = state;
    memset(&ports, 0, sizeof ports);
    for (int axis = 0; axis < 3; axis++) {
      if (which != 1 || axis == 1) {
        port(ports.in, &ports.n_in, FB_PORT_SUPPORT_DISPLACEMENT, at, axis, FB_AXES_BODY);
      }
      if (which == 0) {
        port(ports.in, &ports.n_in, FB_PORT_SUPPORT_ROTATION, at, axis, FB_AXES_BODY);
      }
      port(ports.out, &ports.n_out, FB_PORT_DISPLACEMENT, at, axis, FB_AXES_BODY);
      port(ports.out, &ports.n_out, FB_PORT_DISPLACEMENT, n - 1, axis, FB_AXES_BODY);
      port(ports.out, &ports.n_out, which ? FB_PORT_INTERNAL_MOMENT : FB_PORT_MOMENT_STRAIN, n - 2, axis, FB_AXES_BODY);
    }
    port(ports.out, &ports.n_out, FB_PORT_ROTATION, at, 2, FB_AXES_BODY);
    port(ports.out, &ports.n_out, which ? FB_PORT_INTERNAL_FORCE : FB_PORT_FORCE_STRAIN, 1, 1, FB_AXES_BODY);
    port(ports.out, &ports.n_out, FB_PORT_MOMENT_STRAIN, 1, 2, FB_AXES_BODY);
    FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &steady, &input, &ports, FB_SINGLE ? 12 : all[which]),
               FB_OK);
    for (int i = 0; i < ports.n_in; i++) {
      compare_rest(&rest, i);
      compare_push(worst, most, i);
    }
    for (int o = 0; o < ports.n_out; o++) {
      largest = fmax(largest, worst[o] / most[o]);
    }
  }
  FBT_BELOW(largest, FBT_TOL(4e-3, 0.2));
  fbt_figure("linear model of four elements, its supports moved", "fb_exact_step", largest);
}

/* E12.13, E12.15: the free end of a cantilever whose support shakes goes (cos + cosh)/(1 + cos cosh) of b = sqrt(omega) as far
   as the support, whose place is its output as it is its input. */
TEST(shaken_cantilevers_answer_in_closed_form)
{
  const double k = FBT_TOL(1e8, 1e4), stiffness[6] = {k, k, k, 1.0, 1.0, 2.0},
               inertia[6] = {1.0, 1.0, 1.0, 1e-5, 0.0, 0.0};
  double largest = 0.0;
  beam(1.0, 40, stiffness, inertia);
  desc.root = FB_END_FREE;
  desc.tip = FB_END_CLAMPED;
  settle();
  memset(&ports, 0, sizeof ports);
  port(ports.in, &ports.n_in, FB_PORT_SUPPORT_DISPLACEMENT, 40, 2, FB_AXES_BODY);
  port(ports.out, &ports.n_out, FB_PORT_DISPLACEMENT, 0, 2, FB_AXES_BODY);
  port(ports.out, &ports.n_out, FB_PORT_DISPLACEMENT, 40, 2, FB_AXES_BODY);
  FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &state, &input, &ports, 12), FB_OK);
  for (int i = 0; i <= 40; i++) {
    const double omega = 1.07 * i, b = sqrt(omega);
    const double closed_form = (cos(b) + cosh(b)) / (1.0 + cos(b) * cosh(b));
    double y[2], own[2];
    linear_response(y, 0, 0, omega);
    linear_response(own, 1, 0, omega);
    largest = fmax(largest, fabs(y[0] - closed_form) / (fabs(closed_form) + 1e-1));
    FBT_NEAR_ABS(y[0], closed_form, FBT_TOL(2e-3, 0.3) * (fabs(closed_form) + 1e-1));
    FBT_NEAR_ABS(y[1], 0.0, FBT_TOL(1e-6, 5e-2));
    FBT_NEAR_ABS(own[0], 1.0, FBT_TOL(1e-9, 1e-3));
  }
  fbt_figure("linear model of a shaken cantilever, support to free end, to twice the second frequency", "closed form",
             largest);
}

/* E12.15: tip deflection by a tip force at any frequency, of a uniform cantilever: (sin cosh - cos sinh)/(b^3 (1 + cos
   cosh)) of b = sqrt(omega). */
TEST(linear_beams_answer_at_every_frequency)
{
  double largest = 0.0;
  elastica(40);
  desc.station[0].stiffness[35] = FB_R(2.0);
  desc.station[0].inertia[21] = FB_R(1e-5);
  settle();
  memset(&ports, 0, sizeof ports);
  port(ports.in, &ports.n_in, FB_PORT_FORCE, 40, 2, FB_AXES_BODY);
  port(ports.out, &ports.n_out, FB_PORT_DISPLACEMENT, 40, 2, FB_AXES_INERTIAL);
  FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &state, &input, &ports, 12), FB_OK);
  for (int k = 0; k <= 40; k++) {
    const double omega = 1.1 * k, b = sqrt(omega);
    const double closed_form =
        k == 0 ? 1.0 / 3.0 : (sin(b) * cosh(b) - cos(b) * sinh(b)) / (b * b * b * (1.0 + cos(b) * cosh(b)));
    double y[2];
    linear_response(y, 0, 0, omega);
    largest = fmax(largest, fabs(y[0] - closed_form) / (fabs(closed_form) + 1e-2));
    FBT_NEAR_ABS(y[0], closed_form, FBT_TOL(2e-3, 0.3) * (fabs(closed_form) + 1e-2));
    FBT_NEAR_ABS(y[1], 0.0, FBT_TOL(1e-6, 5e-2));
  }
  fbt_figure("linear model of a cantilever, tip force to tip, to twice the second frequency", "closed form", largest);
}

/* ---- damping and stability */

/* E10.29: about rest a mode of the frequency omega becomes lambda^2 + mu omega^2 lambda + omega^2 = 0 where the damping of
   all strains is mu, with rigid shear and without; that of torsion alone leaves bending as it is, that of one bending the
   other, also of two elements, which bend by rigid shear of their own. */
TEST(damped_modes_have_the_ratio_of_their_frequency)
{
  const double mu = 0.01, stiffness[6] = {1e4, 0.0, 0.0, 1.5, 1.0, 3.0}, inertia[6] = {1.0, 1.0, 1.0, 0.05, 0.02, 0.03};
  for (int run = 0; run < 4; run++) {
    double omega[5], one = 0.0;
    for (int damped = 0; damped < 2; damped++) {
      beam(1.0, run == 3 ? 2 : 12, stiffness, inertia);
      desc.station[0].stiffness[7] = desc.station[0].stiffness[14] = run == 1 ? FB_R(500.0) : FB_R(0.0);
      desc.station[0].curvature[1] = run < 2 ? FB_R(0.7) : FB_R(0.0);
      for (int i = 0; i < 6; i++) {
        desc.damping[i] = damped && (run < 2 || i == run + 1) ? (fb_real)mu : FB_R(0.0);
      }
      settle();
      spectrum_of(5);
      for (int k = 0; k < 5; k++) {
        const double re = (double)spectrum.re[k], im = (double)spectrum.im[k];
        if (!damped) {
          omega[k] = im;
          FBT_NEAR_ABS(re, 0.0, FBT_TOL(1e-9, 1e-2));
        } else if (run < 2) {
          FBT_NEAR_REL(re, -0.5 * mu * omega[k] * omega[k], FBT_TOL(1e-9, 2e-2));
          FBT_NEAR_REL(hypot(re, im), omega[k], FBT_TOL(1e-9, 1e-2));
        } else { /* others are left */
          one = fmax(one, -re);
          FBT_TRUE(fabs(re) < FBT_TOL(1e-9, 1e-2) ||
                   fabs(re / (0.5 * mu * omega[k] * omega[k]) + 1.0) < FBT_TOL(1e-9, 2e-2));
        }
      }
    }
    FBT_TRUE(run < 2 || one > 0.02);
  }
  beam(1.0, 12, stiffness, inertia); /* modes above 2/mu are overdamped, their eigenvalues gather at 1/mu: refused */
  for (int i = 3; i < 6; i++) {
    desc.damping[i] = FB_R(0.2); /* that of stretch, which is rigid, does not count */
  }
  desc.station[0].stiffness[0] = FB_R(0.0);
  settle();
  FBT_NEAR_REL(exact.damping[0], exact.damping[5], 0.0);
  spectrum_of(1);
  FBT_INT_EQ(fb_exact_spectrum_solve(&exact, &spectrum_work, &spectrum, &state, NULL, 6), FB_ERR_CONVERGENCE);
  FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &state, NULL, NULL, 6), FB_ERR_CONVERGENCE);
}

/* E12.15: what the linear model says of stability is what the beam does: Beck's column either side of its flutter load,
   and a shaft with unequal stiffness, that whirls off between its two critical speeds pi^2 sqrt(EI) and only there. */
TEST(linear_beams_flutter_and_whirl)
{
  for (int beyond = 0; beyond < 2; beyond++) {
    double margin;
    elastica(20);
    desc.tip = FB_HOLD_Z;
    load_tip(FB_AXES_NODE, beyond ? -20.2 : -19.9, 0.0, 0.0);
    settle();
    memset(&ports, 0, sizeof ports);
    port(ports.in, &ports.n_in, FB_PORT_FORCE, 12, 1, FB_AXES_NODE);
    port(ports.out, &ports.n_out, FB_PORT_RATE, 20, 2, FB_AXES_INERTIAL);
    FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &state, &input, &ports, 4), FB_OK);
    margin = (double)fb_spectrum_margin(NULL, linear.re, linear.n_mode);
    FBT_TRUE(beyond ? margin < -0.3 : margin > -FBT_TOL(1e-3, 0.1));
  }
  for (int run = 0; run < 3; run++) {
    const double stiffness[6] = {0.0, 0.0, 0.0, 0.0, 1.0, 1.5}, inertia[6] = {1.0, 1.0, 1.0, 0.0, 0.0, 0.0};
    static const double spin[3] = {9.7, 11.0, 12.3}; /* critical: 9.87, 12.09 */
    double margin;
    beam(1.0, 20, stiffness, inertia);
    desc.root = FB_END_PINNED | FB_HOLD_RX;
    desc.tip = FB_HOLD_Y | FB_HOLD_Z;
    input.w[0] = (fb_real)spin[run];
    settle();
    FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &state, &input, NULL, 4), FB_OK);
    margin = (double)fb_spectrum_margin(NULL, linear.re, linear.n_mode);
    FBT_TRUE(run == 1 ? margin < -1.0 : margin > -FBT_TOL(1e-4, 0.3));
  }
}

/* E12.15: what has no linear model is refused, and the model kept. */
TEST(linear_beams_refuse_bad_input)
{
  static fb_exact_linear before;
  linear_case(0, 4);
  FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &steady, NULL, NULL, 2), FB_OK);
  FBT_INT_EQ(linear.n_in + linear.n_out, 0);
  FBT_TRUE(linear.n_mode == 2 && linear.n == 4);
  before = linear;
  FBT_INT_EQ(fb_exact_linearize(NULL, &linear_work, &linear, &steady, &input, &ports, 2), FB_ERR_NULL);
  FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, NULL, &steady, &input, &ports, 2), FB_ERR_NULL);
  FBT_INT_EQ(fb_exact_linearize(&exact, NULL, &linear, &steady, &input, &ports, 2), FB_ERR_NULL);
  FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, NULL, &input, &ports, 2), FB_ERR_NULL);
  FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &steady, &input, &ports, 0), FB_ERR_VALUE);
  FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &steady, &input, &ports, FB_EXACT_MODES + 1),
             FB_ERR_VALUE);
  input.w[1] = (fb_real)NAN;
  FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &steady, &input, &ports, 2), FB_ERR_NOT_FINITE);
  input.w[1] = FB_R(0.0);
  steady.r[4] = (fb_real)NAN;
  FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &steady, &input, &ports, 2), FB_ERR_NOT_FINITE);
  steady = state;
  for (int bad = 0; bad < 8; bad++) {
    static fb_linear_desc wrong;
    wrong = ports;
    wrong.n_in = bad == 0 ? FB_MAX_PORTS + 1 : wrong.n_in;
    wrong.n_out = bad == 1 ? -1 : wrong.n_out;
    wrong.in[0].node = bad == 2 ? 5 : bad == 3 ? -1 : wrong.in[0].node;
    wrong.out[7].node = bad == 4 ? 4 : wrong.out[7].node; /* a node is, an element is not */
    wrong.out[0].axis = bad == 5 ? 3 : 0;
    wrong.in[0].kind = bad == 6 ? FB_PORT_RATE : FB_PORT_FORCE;
    wrong.out[0].kind = bad == 7 ? FB_PORT_COUNT : FB_PORT_DISPLACEMENT;
    FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &steady, &input, &wrong, 2),
               bad < 5 ? FB_ERR_CAPACITY : FB_ERR_VALUE);
  }
  for (int bad = 0; bad < 3; bad++) { /* the root, what nothing holds, a place as an output */
    static fb_linear_desc wrong;
    wrong = ports;
    wrong.in[0].kind = FB_PORT_SUPPORT_DISPLACEMENT;
    wrong.in[0].node = bad == 0 ? 0 : 4;
    wrong.out[0].kind = bad == 2 ? FB_PORT_SUPPORT_ROTATION : wrong.out[0].kind;
    FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &steady, &input, &wrong, 2), FB_ERR_VALUE);
  }
  elastica(4); /* nothing holds it */
  desc.root = FB_END_FREE;
  desc.station[0].inertia[21] = FB_R(0.01);
  start();
  FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &state, &input, &ports, 2), FB_ERR_SINGULAR);
  elastica(4); /* no mass */
  memset(desc.station[0].inertia, 0, sizeof desc.station[0].inertia);
  settle();
  FBT_TRUE(fb_exact_linearize(&exact, &linear_work, &linear, &state, &input, &ports, 2) != FB_OK);
  FBT_TRUE(memcmp(&before, &linear, sizeof linear) == 0);
}

/* E12.18: fb_spectrum_margin: the least -re and whose it is. */
TEST(margins_are_those_of_the_worst_mode)
{
  const fb_real re[4] = {-FB_R(2.0), -FB_R(0.25), FB_R(0.0), -FB_R(1.0)},
                bad[3] = {-FB_R(1.0), (fb_real)NAN, FB_R(1.0)};
  int mode = 9;
  FBT_NEAR_ABS(fb_spectrum_margin(&mode, re, 2), 0.25, 0.0);
  FBT_INT_EQ(mode, 1);
  FBT_NEAR_ABS(fb_spectrum_margin(&mode, re, 4), 0.0, 0.0);
  FBT_INT_EQ(mode, 2);
  FBT_NEAR_ABS(fb_spectrum_margin(&mode, bad, 1), 1.0, 0.0);
  FBT_TRUE(!(fb_spectrum_margin(&mode, bad, 3) <= FB_HUGE)); /* not hidden by those after it */
  FBT_INT_EQ(mode, 1);
  FBT_TRUE(fb_spectrum_margin(&mode, re, 0) >= FB_HUGE);
  FBT_INT_EQ(mode, -1);
  FBT_TRUE(fb_spectrum_margin(NULL, NULL, 3) >= FB_HUGE);
}

/* Interface: bad input is refused and changes nothing. */
TEST(exact_beam_refuses_bad_input)
{
  static fb_exact_state before;
  static fb_exact other;
  elastica(4);
  FBT_INT_EQ(fb_exact_init(&exact, NULL), FB_ERR_NULL);
  desc.n_element = FB_MAX_EXACT + 1;
  FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_ERR_CAPACITY);
  desc.n_element = 4;
  desc.length = FB_R(0.0);
  FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_ERR_VALUE);
  desc.length = (fb_real)NAN;
  FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_ERR_NOT_FINITE);
  desc.length = FB_R(1.0);
  desc.station[0].stiffness[28] = FB_R(-1.0);
  FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_ERR_VALUE);
  desc.station[0].stiffness[28] = FB_R(1.0);
  desc.station[0].stiffness[29] = desc.station[0].stiffness[34] = FB_R(2.0); /* not positive definite */
  FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_ERR_VALUE);
  desc.station[0].stiffness[29] = FB_R(0.5);
  FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_ERR_VALUE); /* not symmetric */
  desc.station[0].stiffness[29] = desc.station[0].stiffness[34] = FB_R(0.0);
  desc.dissipation = FB_R(0.9);
  FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_ERR_VALUE);
  desc.dissipation = FB_R(0.0);
  desc.damping[3] = -FB_R(1.0);
  FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_ERR_VALUE);
  desc.damping[3] = FB_R(0.5);
  desc.station[0].stiffness[28] = FB_R(0.0);
  FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_OK);
  desc.station[0].curvature[0] = FB_R(0.7); /* one bending is rigid, about an axis that turns along an element */
  FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_ERR_VALUE);
  FBT_INT_EQ(fb_exact_state_init(&exact, &state, &work, NULL), FB_ERR_INIT);
  for (int i = 0; i < 6; i++) {
    desc.damping[i] = FB_R(0.5);
  }
  FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_OK);
  memset(desc.damping, 0, sizeof desc.damping);
  desc.station[0].curvature[0] = FB_R(0.0);
  desc.station[0].stiffness[28] = FB_R(1.0);
  desc.tip = 99;
  FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_ERR_VALUE);
  desc.tip = FB_END_DEFAULT;
  desc.factorizations = 21;
  FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_ERR_VALUE);
  desc.factorizations = 0;
  start();
  other = exact;
  desc.root = -1;
  FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_ERR_VALUE);
  FBT_TRUE(memcmp(&other, &exact, sizeof exact) == 0);
  before = state;
  input.n_load = 1;
  input.load[0].node = 5;
  FBT_INT_EQ(fb_exact_trim(&exact, &state, &work, &input), FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_exact_step(&exact, &state, &work, &input, FB_R(0.01)), FB_ERR_CAPACITY);
  input.load[0].node = 4;
  input.load[0].force[1] = (fb_real)INFINITY;
  FBT_INT_EQ(fb_exact_trim(&exact, &state, &work, &input), FB_ERR_NOT_FINITE);
  input.load[0].force[1] = FB_R(1e6);
  FBT_INT_EQ(fb_exact_trim(&exact, &state, &work, &input), FB_ERR_CONVERGENCE);
  FBT_INT_EQ(fb_exact_step(&exact, &state, &work, &input, FB_R(10.0)), FB_ERR_CONVERGENCE);
  FBT_INT_EQ(fb_exact_step(&exact, &state, &work, &input, FB_R(0.0)), FB_ERR_VALUE);
  FBT_INT_EQ(fb_exact_step(&exact, &state, &work, &input, (fb_real)NAN), FB_ERR_VALUE);
  FBT_INT_EQ(fb_exact_step(&exact, &state, &work, &input, FB_R(2.0) * FB_HUGE), FB_ERR_VALUE);
  FBT_INT_EQ(fb_exact_spectrum_solve(&exact, &spectrum_work, &spectrum, &state, NULL, 0), FB_ERR_VALUE);
  FBT_TRUE(memcmp(&before, &state, sizeof state) == 0);
}

/* Interface: a state that came from elsewhere: one that is not a number, in the first or the last place of any field,
   is refused. */
TEST(states_that_are_not_numbers_are_refused)
{
  fb_real *const field[] = {state.base_position, state.base_quat,   state.r,
                            state.quat,          state.strain,      state.momentum,
                            state.velocity,      state.strain_rate, state.momentum_rate,
                            state.velocity_rate, state.V[0],        state.V[1],
                            state.V[2],          state.stress[0],   state.stress[1],
                            state.stress[2],     state.force,       state.reaction,
                            state.offset,        &state.step,       state.u,
                            state.lost};
  elastica(4);
  desc.n_lump = 2;
  desc.lump[0].node = 4;
  desc.lump[1].node = 2;
  desc.lump[0].mass = desc.lump[1].mass = FB_R(0.5);
  start();
  {
    const int nodes = 6 * 5, cells = 6 * 4;
    const int size[] = {3,     4,     3 * 5, 4 * 5, cells, cells, nodes, cells, cells, nodes, nodes,
                        nodes, nodes, cells, cells, cells, nodes, nodes, cells, 1,     3,     3};
    FBT_INT_EQ(fb_exact_state_check(&exact, &state), FB_OK);
    for (int k = 0; k < 2 * FBT_COUNT(size); k++) {
      fb_real *const x = field[k / 2] + (k % 2) * (size[k / 2] - 1), right = *x;
      *x = (fb_real)NAN;
      FBT_INT_EQ(fb_exact_state_check(&exact, &state), FB_ERR_NOT_FINITE);
      *x = right;
    }
    FBT_INT_EQ(fb_exact_state_check(&exact, &state), FB_OK);
  }
}

/* Interface: a model whose counts are beyond the tables, or below zero, is refused by every function that takes a
   state, and what they fill is left alone. */
TEST(models_with_impossible_counts_are_refused)
{
  static fb_exact_state before;
  static const int count[5][2] = {{FB_MAX_EXACT + 1, 0}, {0, 0}, {-1, 0}, {4, FB_MAX_LUMPS + 1}, {4, -1}};
  elastica(4);
  start();
  before = state;
  for (int k = 0; k < FBT_COUNT(count); k++) {
    fb_exact_element cell;
    fb_energy energy = {FB_R(7.0), FB_R(7.0), FB_R(7.0)};
    fb_momentum momentum = {{FB_R(7.0), FB_R(7.0), FB_R(7.0)}, {FB_R(7.0), FB_R(7.0), FB_R(7.0)}};
    fb_real position[3], quat[4];
    const fb_status refused = count[k][0] == 0 ? FB_ERR_INIT : FB_ERR_CAPACITY; /* as never initialized */
    exact.n = count[k][0];
    exact.n_joint = count[k][1];
    FBT_INT_EQ(fb_exact_check(&exact), FB_ERR_CAPACITY);
    FBT_INT_EQ(fb_exact_state_check(&exact, &state), refused);
    FBT_INT_EQ(fb_exact_state_init(&exact, &state, &work, NULL), refused);
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), refused);
    FBT_INT_EQ(fb_exact_element_eval(&exact, &cell, &state, 0), FB_ERR_CAPACITY); /* the index first */
    FBT_INT_EQ(fb_exact_point_eval(&exact, position, quat, &state, FB_R(0.5)), refused);
    FBT_INT_EQ(fb_exact_energy_eval(&exact, &energy, &state), refused);
    FBT_INT_EQ(fb_exact_momentum_eval(&exact, &momentum, &state), refused);
    FBT_INT_EQ(fb_exact_step(&exact, &state, &work, NULL, FB_R(0.01)), refused);
    FBT_NEAR_ABS(energy.kinetic + energy.strain + energy.gravity, 21.0, 0.0);
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(momentum.linear[i], 7.0, 0.0);
      FBT_NEAR_ABS(momentum.angular[i], 7.0, 0.0);
    }
  }
  FBT_TRUE(memcmp(&before, &state, sizeof state) == 0);
}

static unsigned beam_word(void)
{
  return fb_exact_crc(&exact);
}

/* E8.40: of an exact beam the word sees all but the unused room of its tables. */
TEST(the_check_word_of_a_exact_beam_sees_every_byte)
{
  int unused;
  elastica(3);
  desc.n_joint = 1;
  desc.joint[0].element = 1;
  desc.joint[0].axis[1] = FB_R(2.0);
  desc.n_lump = 2;
  for (int l = 0; l < 2; l++) {
    desc.lump[l].node = l + 1;
    desc.lump[l].mass = FB_R(2.0);
  }
  start();
  FBT_INT_EQ(exact.n_joint, 1);
  unused = (FB_MAX_EXACT - 3) * ((1 + 6 + 7 * 36 + 4 + 20 + 4 + 3 + 4) * (int)sizeof(fb_real) + 3 * (int)sizeof(int)) +
           (1 + FB_MAX_LUMPS) * (int)sizeof(int) + /* inboard of no element, branches */
           (FB_MAX_LUMPS - 1) * (int)sizeof(fb_exact_joint);
  FBT_TRUE(fbt_unseen(&exact, sizeof exact, beam_word) <= unused + (int)(sizeof(fb_real) - sizeof(int)));
  exact.n_joint = FB_MAX_LUMPS + 1;
  FBT_INT_EQ(beam_word() == 0, 1);
}

SUITE(exact_linear, RUN(linear_beams_follow_the_unit_of_time), RUN(the_check_word_of_a_exact_beam_sees_every_byte),
      RUN(states_that_are_not_numbers_are_refused), RUN(models_with_impossible_counts_are_refused),
      RUN_LONG(linear_beams_rest_where_the_beam_does), RUN(equal_frequencies_are_kept_together),
      RUN(frequencies_are_equal_to_a_part_in_a_hundred_thousand), RUN_LONG(linear_beams_move_as_the_beam_does),
      RUN(linear_beams_answer_at_every_frequency), RUN(moved_supports_are_inputs_of_linear_beams),
      RUN(shaken_cantilevers_answer_in_closed_form), RUN(damped_modes_have_the_ratio_of_their_frequency),
      RUN(linear_beams_flutter_and_whirl), RUN(linear_beams_refuse_bad_input), RUN(margins_are_those_of_the_worst_mode),
      RUN(exact_beam_refuses_bad_input))
