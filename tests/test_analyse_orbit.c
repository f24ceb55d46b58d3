/* >>trim and >>linear: bodies in orbit about a center of gravity: steady states that turn with the orbit, their librations
   and vibrations. The judge is closed forms of satellites, Hill's equations, Wright's rotating beams, and motion by the
   integrator. */
#include "analyse.h"

static fb_analyse_work work;
static fb_state state;
static fb_input input;
static fb_motion motion;
static fb_body_desc desc;
static const double mu = 3.986004418e14, low = 7e6; /* [m^3/s^2], [m] a low orbit about the Earth */

static double rate_at(double d)
{
  return sqrt(mu / (d * d * d));
}

static void describe(unsigned effects, double of)
{
  memset(&desc, 0, sizeof desc);
  desc.effects = effects;
  desc.mu = (fb_real)of;
  memset(&input, 0, sizeof input);
}

/* A rigid body, its mass center at c, with these moments of inertia about that; a node away from it. */
static void satellite(double mass, double c, const double J[3])
{
  const fb_real center[3] = {(fb_real)c, (fb_real)(0.5 * c), (fb_real)-c}, arm[3] = {FB_R(0.7), FB_R(0.4), -FB_R(0.2)};
  const fb_real inertia[6] = {(fb_real)J[0], (fb_real)J[1], (fb_real)J[2], 0, 0, 0};
  int node;
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)mass, center, inertia), FB_OK);
  FBT_INT_EQ(fb_shape_add_node(&shape, &node, arm, NULL, NULL), FB_OK);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
}

/* At distance d along x of the center, turned by `turn`, to orbit at the rate n about inertial z. */
static void place(double d, double n, double x, double y, double z)
{
  const fb_real turn[3] = {(fb_real)x, (fb_real)y, (fb_real)z}, w[3] = {0, 0, (fb_real)n};
  fb_real R[9];
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  fb_quat_from_rotvec(state.quat, turn);
  fb_quat_to_mat33(R, state.quat);
  fb_mat33_mulT_vec3(input.w, R, w);
  for (int i = 0; i < 3; i++) {
    state.rho[i] = body.center[i];
  }
  state.rho[0] += (fb_real)d;
}

static void trim(void)
{
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_OK);
  FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &input), FB_OK);
}

static void solve(void)
{
  FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, &spectrum, &state, &input), FB_OK);
  FBT_BELOW((double)work.common.linear.error, FBT_TOL(1e-10, 1e-3)); /* as examples/MODELS.md says */
}

/* Is re + i im, 1/s, among the eigenvalues? */
static void among(double re, double im, double tolerance)
{
  double nearest = 1e9;
  for (int k = 0; k < spectrum.n; k++) {
    nearest = fmin(nearest, hypot((double)spectrum.re[k] - re, (double)spectrum.im[k] - im));
  }
  FBT_NEAR_ABS(nearest, 0.0, tolerance);
}

/* Axis i of the body in inertial axes, along k. */
static double axis(int i, int k)
{
  fb_real R[9];
  fb_quat_to_mat33(R, state.quat);
  return (double)R[3 * k + i];
}

/* ---- rigid satellites */

/* E12.40: from an attitude 11 degrees off, a wrong distance and a plane that the attitude only suggests, a satellite
   comes to hang by the principal axes nearest to vertical and normal, whichever they are; at the distance where
   n^2 = mu/d^3 + 3 mu (tr J - 3 J_r)/(2 m d^5), J_r about the vertical. Close to a weak center, so that the second
   degree counts. */
TEST(rigid_satellites_hang_by_principal_axes)
{
  const double J[3] = {30.0, 90.0, 110.0}, mass = 40.0, weak = 900.0, far = 20.0, n = sqrt(weak / (far * far * far));
  const double quarter = 0.5 * pi;
  for (int run = 0; run < 6; run++) { /* cyclic by a third of a turn about (1, 1, 1), then with a quarter about x */
    const double third = 2.0 * pi / 3.0 / sqrt(3.0) * (run % 3);
    const fb_real turn[3] = {(fb_real)third, (fb_real)third, (fb_real)third}, last[3] = {(fb_real)quarter, 0, 0};
    const fb_real off[3] = {FB_R(0.12), -FB_R(0.1), FB_R(0.11)};
    fb_real a[4], b[4], c[4], R[9];
    double Jr = 0.0, d = far;
    describe(0, weak);
    desc.center[1] = FB_R(3.0);
    satellite(mass, 0.2, J);
    place(1.2 * far, n, 0, 0, 0);
    fb_quat_from_rotvec(a, last);
    fb_quat_from_rotvec(b, turn);
    fb_quat_mul(c, a, b);
    memcpy(a, run < 3 ? b : c, sizeof a);
    fb_quat_from_rotvec(b, off);
    fb_quat_mul(state.quat, b, a);
    fb_quat_to_mat33(R, state.quat);
    for (int i = 0; i < 3; i++) {
      input.w[i] = (fb_real)(n * (double)R[6 + i]);
    }
    trim();
    for (int i = 0; i < 3; i++) {
      int whole = 0;
      double up = 0.0;
      for (int k = 0; k < 3; k++) {
        whole += fabs(fabs((double)motion.w[k]) - (i == k ? n : 0.0)) < FBT_TOL(1e-12, 1e-5) * n;
        up += axis(i, k) * ((double)state.rho[k] - (double)desc.center[k]);
      }
      Jr = fabs(up) > 0.9 * far ? J[i] : Jr;
      FBT_TRUE(whole == 3 || whole == 1);
    }
    for (int k = 0; k < 20; k++) {
      d = cbrt(weak / (n * n) * (1.0 + 1.5 * (J[0] + J[1] + J[2] - 3.0 * Jr) / (mass * d * d)));
    }
    FBT_NEAR_REL(sqrt((double)fb_vec3_dot(state.u, state.u)) / n, d, FBT_TOL(1e-12, 1e-5));
  }
}

/* E12.40: a body symmetric about the vertical is in balance at any angle about it, and stays at that. */
TEST(symmetric_satellites_keep_their_angle)
{
  const double J[3] = {10.0, 100.0, 100.0}, n = rate_at(low), angle = 0.4;
  describe(0, mu);
  satellite(400.0, 0.0, J);
  place(low, n, angle, 0, 0);
  trim();
  FBT_NEAR_ABS(axis(1, 2), sin(angle), FBT_TOL(1e-9, 1e-3));
  solve();
  among(0.0, sqrt(3.0 * (J[1] - J[0]) / J[2]) * n, FBT_TOL(1e-10, 2e-3) * n);
  among(0.0, n * sqrt(1.0 + 3.0 * (J[1] - J[0]) / J[2]), FBT_TOL(1e-10, 2e-3) * n);
}

/* E12.2 about E12.40: pitch at n sqrt(3 (J_r - J_y)/J_p); roll and yaw s^4 + (1 + 3 a + a b) n^2 s^2 + 4 a b n^4 = 0,
   a = (J_p - J_y)/J_r, b = (J_p - J_r)/J_y ([HS] 9.2), r along the flight, y along the radius, p normal to the orbit;
   the orbit itself 0, 0 and twice +-i n ([HS] 8). Of a satellite that librates, one that falls over in pitch, one in the
   region of DeBra and Delp, where gyroscopic terms hold roll and yaw against the gradient, and one beyond it, whose
   roll and yaw swing ever further. */
TEST(satellites_librate_as_debra_and_delp_say)
{
  static const double set[4][3] = {{90.0, 110.0, 30.0}, {80.0, 100.0, 95.0}, {100.0, 72.0, 80.0}, {100.0, 73.0, 88.0}};
  const double d = low, n = rate_at(d), tolerance = FBT_TOL(1e-10, 2e-3) * n;
  double largest = 0.0;
  for (int k = 0; k < 4; k++) {
    const double Jr = set[k][0], Jp = set[k][1], Jy = set[k][2], J[3] = {Jy, Jr, Jp};
    const double a = (Jp - Jy) / Jr, b = (Jp - Jr) / Jy, half = 0.5 * (1.0 + 3.0 * a + a * b);
    const double pitch = 3.0 * (Jr - Jy) / Jp, square = half * half - 4.0 * a * b, root = sqrt(fabs(square));
    int orbits = 0;
    describe(0, mu);
    satellite(400.0, 0.0, J);
    place(d, n, 0, 0, 0);
    trim();
    solve();
    FBT_INT_EQ(work.common.linear.n, 12);
    among(pitch < 0.0 ? n * sqrt(-pitch) : 0.0, pitch > 0.0 ? n * sqrt(pitch) : 0.0, tolerance);
    for (int side = -1; side < 2; side += 2) {
      if (square > 0.0) { /* s^2 = -half +- root */
        const double s = -half + side * root;
        among(s > 0.0 ? n * sqrt(s) : 0.0, s < 0.0 ? n * sqrt(-s) : 0.0, tolerance);
      } else { /* s^2 = -half +- i root */
        const double size = sqrt(sqrt(half * half + root * root)), angle = 0.5 * atan2(root, -half);
        among(side * n * size * cos(angle), n * size * sin(angle), tolerance);
      }
    }
    among(0.0, 0.0, FBT_TOL(1e-6, 2e-2) * n); /* double */
    for (int i = 0; i < spectrum.n; i++) {
      if (fabs((double)spectrum.im[i] - n) < FBT_TOL(1e-3, 2e-2) * n) {
        largest = fmax(largest, hypot((double)spectrum.re[i], (double)spectrum.im[i] - n) / n);
        orbits++;
      }
    }
    FBT_INT_EQ(orbits, 2);
    FBT_BELOW(largest * n, tolerance);
    FBT_TRUE((square < 0.0) == (k == 3));
    FBT_TRUE((pitch < 0.0) == (k == 1));
  }
  fbt_figure("eigenvalues of a circular orbit", "+-i n", largest);
}

/* E12.40 in balance with a torque: T about pitch turns the vertical by sin 2 x = 2 T/(3 n^2 (J_r - J_y)); a force F along
   the normal holds a sphere F/(m n^2) beside the plane through the center. */
TEST(loads_in_orbit_are_borne_by_the_gradient)
{
  const double J[3] = {30.0, 90.0, 110.0}, ball[3] = {50.0, 50.0, 50.0}, n = rate_at(low), T = 3e-5, F = 2e-4;
  describe(0, mu);
  satellite(400.0, 0.0, J);
  place(low, n, 0, 0, 0);
  input.n_load = 1;
  input.load[0].axes = FB_AXES_BODY;
  input.load[0].torque[2] = (fb_real)T;
  trim();
  FBT_NEAR_REL(2.0 * axis(0, 1) * axis(0, 0), 2.0 * T / (3.0 * n * n * (J[1] - J[0])), FBT_TOL(1e-10, 1e-4));
  satellite(400.0, 0.0, ball);
  place(low, n, 0, 0, 0);
  input.load[0].torque[2] = 0;
  input.load[0].force[2] = (fb_real)F;
  trim();
  FBT_NEAR_REL((double)state.rho[2], F / (400.0 * n * n), FBT_TOL(1e-8, 1e-4));
  FBT_NEAR_ABS(axis(0, 0), 1.0, FBT_TOL(1e-12, 1e-5)); /* in balance at any attitude */

  /* along the flight it has no steady state, nor has a torque too large */
  place(low, n, 0, 0, 0);
  input.load[0].force[2] = 0;
  input.load[0].force[1] = (fb_real)FBT_TOL(10.0 * F, 1.0);
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_UNREST);
  satellite(400.0, 0.0, J);
  place(low, n, 0, 0, 0);
  input.load[0].force[1] = 0;
  input.load[0].torque[2] = (fb_real)(100.0 * T);
  FBT_TRUE(fb_body_trim(&body, &state, &work, &input) != FB_OK);
}

/* E12.40 of gyrostats: the momentum h of a wheel along the vertical, x, tilts it about the flight, by
   sin a = h/(n (4 (J_z - J_x) - 3 I)), I its inertia about its axis, which J_x is without: the gradient and the orbit against
   the wheel. */
TEST(gyrostats_in_orbit_tilt)
{
  const double J[3] = {30.0, 90.0, 110.0}, I = 0.4, n = rate_at(low);
  for (int run = 0; run < 4; run++) {
    const double h = run == 0 ? 0.0 : run == 1 ? 0.05 : run == 2 ? -0.1 : 0.2;
    const double want = h / (n * (4.0 * (J[2] - J[0]) - 3.0 * I));
    describe(0, mu);
    desc.n_rotor = 1;
    desc.rotor[0].axis[0] = FB_R(1.0);
    desc.rotor[0].inertia = (fb_real)I;
    satellite(400.0, 0.0, J);
    place(low, n, 0, 0, 0);
    state.pi[body.n] = (fb_real)h;
    trim();
    FBT_NEAR_REL((double)motion.rotor_momentum[0], h, FBT_TOL(1e-13, 1e-6));
    FBT_NEAR_ABS(axis(0, 2), want, FBT_TOL(1e-11, 1e-4));
    FBT_NEAR_ABS(axis(1, 2), 0.0, FBT_TOL(1e-11, 1e-4));
  }
}
/* ---- flexible ones */

/* E12.2: a particle on springs beside a hub too heavy to move, along the vertical (x), the flight (y) or the normal (z):
   s^2 x - 2 n s y + (k_x - 3 n^2) x = 0, s^2 y + 2 n s x + k_y y = 0, s^2 z + (k_z + n^2) z = 0 (Hill's equations with
   springs), wherever it stands: the equations are linear in place. */
TEST(particles_on_springs_obey_hill)
{
  const double n = rate_at(low), k[3] = {9.0 * n * n, 2.0 * n * n, 5.0 * n * n};
  const double A = k[0] - 3.0 * n * n, B = k[1], half = 0.5 * (A + B + 4.0 * n * n), root = sqrt(half * half - A * B);
  const double heavy = FBT_TOL(1e12, 1e6);
  const fb_real zero[3] = {0}, J[6] = {(fb_real)heavy, (fb_real)(2.0 * heavy), (fb_real)(3.0 * heavy), 0, 0, 0};
  for (int at = 0; at < 3; at++) {
    fb_real r[3] = {0}, psi[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    r[at] = FB_R(10.0);
    describe(FB_EFFECTS_FULL, mu);
    desc.deflection_limit = FB_R(100.0);
    desc.allow_split_effects = 1;
    FBT_INT_EQ(fb_shape_init(&shape, 3), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)FBT_TOL(1e9, 1e6), zero, J), FB_OK);
    FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(1.0), r, psi, NULL), FB_OK);
    for (int i = 0; i < 3; i++) {
      shape.K[4 * i] = (fb_real)k[i];
    }
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
    place(low, n, 0, 0, 0);
    trim();
    solve();
    among(0.0, sqrt(half + root), FBT_TOL(3e-8, 2e-3) * n);
    among(0.0, sqrt(half - root), FBT_TOL(3e-8, 2e-3) * n);
    among(0.0, sqrt(k[2] + n * n), FBT_TOL(3e-8, 2e-3) * n);
    FBT_NEAR_ABS((double)state.q[0], at == 0 ? 3.0 * n * n * 10.0 / A : 0.0, FBT_TOL(1e-6, 1e-2));
    FBT_NEAR_ABS((double)state.q[2], at == 2 ? -n * n * 10.0 / (k[2] + n * n) : 0.0, FBT_TOL(1e-6, 1e-2));
  }
}

/* E12.2, closed form and published: along the vertical a boom on a hub too heavy to move bears the tension
   3 n^2 m' (L^2 - x^2)/2, that of a blade which turns at sqrt(3) n, and beside it no force in the plane of the orbit, n^2 m'
   z across it: its frequencies are those of Wright et al. (1982) in flap at eta = sqrt(3) n sqrt(m' L^4/EI), squared and
   with n^2 across the plane. */
TEST(booms_along_the_vertical_bend_faster)
{
  static const double wright[3][3] = {{0.0, 3.5160, 22.0345}, {3.0, 4.7973, 23.3203}, {6.0, 7.3604, 26.8091}};
  const fb_real zero[3] = {0}, J[6] = {FB_R(1e12), FB_R(2e12), FB_R(3e12), 0, 0, 0};
  const double L = 60.0, m = 0.3, n = rate_at(low);
  for (int k = 1; k < 3; k++) {
    const double unit = sqrt(3.0) * n / wright[k][0];
    uniform_line(L, 12, m, unit * unit * m * L * L * L * L, unit * unit * m * L * L * L * L,
                 FB_MAX_MODES / 4 < 6 ? 4 : 6);
    level.effects = FB_EFFECTS_FULL;
    level.mu = (fb_real)mu;
    level.base = FB_BASE_FREE;
    memset(&input, 0, sizeof input);
    beam_body(&body, 1e9, zero, J);
    place(low, n, 0, 0, 0);
    trim();
    solve();
    for (int i = 1; i < 3; i++) {
      const double in = unit * wright[k][i];
      among(0.0, in, FBT_TOL(2e-4, 4e-3) * in);
      among(0.0, sqrt(in * in + n * n), FBT_TOL(2e-4, 4e-3) * in);
    }
  }
}

/* A boom on a hub, with wheels where there are any, close to a weak center; hung by Newton's method from an attitude
   beside. */
static double bent_craft(unsigned effects, fb_base base)
{
  const fb_real center[3] = {FB_R(0.1), -FB_R(0.05), FB_R(0.2)},
                J[6] = {FB_R(3.0), FB_R(4.0), FB_R(6.0), FB_R(0.3), 0, 0};
  const double d = 400.0, n = 0.05;
  uniform_line(8.0, 6, 0.5, 60.0, 90.0, 2);
  level.effects = effects;
  level.base = base;
  level.mu = (fb_real)(n * n * d * d * d);
  level.center[2] = FB_R(30.0);
  level.n_rotor = 2;
  level.rotor[0].axis[0] = level.rotor[1].axis[1] = FB_R(1.0);
  level.rotor[0].inertia = level.rotor[1].inertia = FB_R(0.05);
  level.rotor[1].node = 1;
  memset(&input, 0, sizeof input);
  beam_body(&body, 20.0, center, J);
  place(d, n, 0.1, -0.05, 0.2);
  fbt_fill(state.q, body.n, 0.01);
  for (int r = body.n; r < body.n_coordinate; r++) {
    state.pi[r] = FB_R(0.3);
  }
  if (base == FB_BASE_FREE) {
    trim();
  }
  return n;
}

/* E12.40: the steady state stays, whatever the set of effects: after two orbits q is as it was, the attitude has turned
   with the orbit, and the distance is the same. */
TEST(satellites_stay_in_their_steady_state)
{
  static const unsigned set[] = {FB_EFFECTS_FULL, FB_EFFECTS_LARGE};
  static fb_rk4_work rk4;
  const int steps = FBT_LONG(24000, 12000);
  for (int k = 0; k < (FB_WITH_LARGE_DEFLECTION ? 2 : 1); k++) {
    const double n = bent_craft(set[k], FB_BASE_FREE), dt = 4.0 * pi / n / steps;
    const fb_state first = state;
    FBT_TRUE(fbt_largest(first.q, body.n) > 1e-3);
    for (int i = 0; i < steps; i++) {
      FBT_INT_EQ(fb_rk4_step(&body, &state, &rk4, &input, &input, &input, (fb_real)dt), FB_OK);
    }
    FBT_BELOW(fbt_difference(state.q, first.q, body.n), FBT_TOL(1e-11, 1e-3));
    FBT_BELOW(fbt_difference(state.quat, first.quat, 4), FBT_TOL(1e-11, 1e-2));
    FBT_BELOW(fbt_difference(state.rho, first.rho, 3), FBT_TOL(1e-11, 1e-2) * 400.0);
  }
}

/* Outputs of the ports at a state, by the functions for one state: gyros, displacements, accelerometers, rotations. */
static void read_ports(double *y, const fb_linear_desc *ports, const fb_state *at, const fb_input *loads)
{
  FBT_INT_EQ(fb_body_motion_eval(&body, &motion, at, loads), FB_OK);
  for (int k = 0; k < ports->n_out; k++) {
    const fb_port *const port = &ports->out[k];
    fb_node_motion node;
    fb_real g[3];
    fb_imu imu;
    FBT_INT_EQ(fb_body_node_motion_eval(&body, &node, at, &motion, port->node), FB_OK);
    FBT_INT_EQ(fb_body_gravity_eval(&body, g, node.position), FB_OK);
    fb_imu_eval(&imu, &node, g);
    y[k] = (double)(port->kind == FB_PORT_RATE           ? imu.angular_rate
                    : port->kind == FB_PORT_DISPLACEMENT ? node.displacement
                    : port->kind == FB_PORT_ACCELERATION ? imu.specific_force
                                                         : node.rotation)[port->axis];
  }
}

/* E12.2 about E12.40: the linear model, integrated, answers to a torque on the hub and a force on the tip as the body does
   in its orbit. Half the loads: a quarter of what is left. The pose relative to the orbit, position and angles alike, are
   the last six of x; a gyro feels the first three through the gradient alone. */
TEST(linear_models_answer_as_the_satellite_does)
{
  static fb_rk4_work rk4;
  static fb_linear linear;
  const int steps = 3000;
  double error[2][8], most[8] = {0.0};
  const double n = bent_craft(FB_EFFECTS_FULL, FB_BASE_FREE), dt = 0.3 * 2.0 * pi / n / steps;
  const fb_state steady = state;
  fb_linear_desc ports;
  memset(&ports, 0, sizeof ports);
  ports.n_in = 2;
  ports.in[0].kind = FB_PORT_TORQUE;
  ports.in[0].axis = 1;
  ports.in[1].kind = FB_PORT_FORCE;
  ports.in[1].node = 1;
  ports.in[1].axis = 2;
  ports.n_out = 8;
  for (int k = 0; k < 8; k++) {
    ports.out[k].kind = k < 3   ? FB_PORT_RATE
                        : k < 5 ? FB_PORT_DISPLACEMENT
                        : k < 7 ? FB_PORT_ACCELERATION
                                : FB_PORT_ROTATION;
    ports.out[k].node = k < 2 ? 0 : 1;
    ports.out[k].axis = k < 2 ? k + 1 : 1 + k % 2;
  }
  FBT_INT_EQ(fb_body_linearize(&body, &work, &linear, &steady, &input, &ports), FB_OK);
  FBT_INT_EQ(linear.n, 2 * (body.n + 6) + linear.n_rotor);
  for (int half = 0; half < 2; half++) {
    const double size = FBT_TOL(1e-3, 2e-2) / (1 + half);
    double x[FB_MAX_LINEAR] = {0.0}, base[8], y[8];
    memset(error[half], 0, sizeof error[half]);
    state = steady;
    read_ports(base, &ports, &state, &input);
    for (int i = 0; i < steps; i++) {
      const double u[2] = {size, 0.1 * size * cos(0.01 * i)};
      fb_input loads = input;
      loads.n_load = 2;
      loads.load[0].axes = loads.load[1].axes = FB_AXES_BODY;
      loads.load[0].torque[1] = (fb_real)u[0];
      loads.load[1].force[2] = (fb_real)u[1];
      loads.load[1].node = 1;
      FBT_INT_EQ(fb_rk4_step(&body, &state, &rk4, &loads, &loads, &loads, (fb_real)dt), FB_OK);
      linear_step(x, &linear, u, dt);
      read_ports(y, &ports, &state, &loads);
      for (int k = 0; k < 8; k++) {
        error[half][k] = fmax(error[half][k], fabs(y[k] - base[k] - linear_output(&linear, x, u, k)));
        most[k] = half ? most[k] : fmax(most[k], fabs(y[k] - base[k]));
      }
    }
  }
  for (int k = 0; k < 8; k++) {
    FBT_BELOW(error[0][k] / most[k], FBT_TOL(2e-2, 0.2));
    FBT_TRUE(FB_SINGLE || fabs(error[0][k] / error[1][k] - 4.0) < 0.5);
  }
}

/* U of a pendulum on a pin at distance d above the center, its mass center l from the pin, x from hanging, its inertia J
   across and K along: to second degree about the mass center. */
static double pendulum_potential(double m, double J, double K, double of, double d, double l, double x)
{
  const double r = sqrt(d * d + l * l - 2.0 * d * l * cos(x)), s = d * sin(x) / r;
  return -of * m / r - of * (2.0 * J + K - 3.0 * (K + (J - K) * s * s)) / (2.0 * r * r * r);
}

/* E12.1 and E12.2 of a base that the field pulls at one place: a pendulum on a pin hangs, and swings at sqrt(U''/J_O); on its
   side it has no state of rest. */
TEST(pins_hold_pendulums_above_a_center)
{
  const double of = 9e3, d = 30.0, l = 2.0, m = 3.0, J = 1.0, K = 0.2, x = 1e-3;
  const fb_real center[3] = {FB_R(2.0), 0, 0}, inertia[6] = {FB_R(0.2), FB_R(1.0), FB_R(1.0), 0, 0, 0};
  const double curve = 2.0 * (pendulum_potential(m, J, K, of, d, l, x) - pendulum_potential(m, J, K, of, d, l, 0.0));
  describe(0, of);
  desc.base = FB_BASE_PINNED;
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)m, center, inertia), FB_OK);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  place(d, 0.0, 0.0, 0.0, pi);
  trim();
  solve();
  among(0.0, sqrt(curve / (x * x) / (J + m * l * l)), FBT_TOL(1e-5, 1e-2));
  place(d, 0.0, 0.0, 0.0, 0.5 * pi);
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_UNREST);
}

/* Interface: what has no steady state, and what is refused. */
TEST(orbits_that_are_none_are_refused)
{
  const double J[3] = {30.0, 90.0, 110.0}, n = rate_at(low);
  fb_state kept;
  describe(0, mu);
  satellite(400.0, 0.0, J);
  place(low, n, 0, 0, 0);
  kept = state;

  /* at rest it falls; the rate along the vertical, not finite, so high that the orbit is inside the body */
  memset(input.w, 0, sizeof input.w);
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_UNREST);
  input.w[0] = (fb_real)n;
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_VALUE);
  input.w[1] = (fb_real)(0.09 * n); /* a tenth of the rate has to be across */
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_VALUE);
  input.w[1] = (fb_real)(0.11 * n);
  FBT_TRUE(fb_body_trim(&body, &state, &work, &input) != FB_ERR_VALUE);
  state = kept;
  input.w[1] = (fb_real)NAN;
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_NOT_FINITE);
  input.w[1] = FB_R(1e8);
  FBT_TRUE(fb_body_trim(&body, &state, &work, &input) != FB_OK);
  FBT_TRUE(memcmp(&kept, &state, sizeof state) == 0);

  /* at the center; linear models and spectra, too */
  memcpy(state.rho, body.center, sizeof state.rho);
  input.w[1] = (fb_real)n;
  FBT_TRUE(fb_body_trim(&body, &state, &work, &input) != FB_OK);
  FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, &spectrum, &state, &input), FB_ERR_RANGE);

  /* uniform gravity beside the center */
  describe(FB_EFFECT_GRAVITY, mu);
  desc.gravity[1] = FB_R(1e-3);
  satellite(400.0, 0.0, J);
  place(low, n, 0, 0, 0);
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_ERR_UNREST);
}
SUITE(analyse_orbit, RUN(rigid_satellites_hang_by_principal_axes), RUN(symmetric_satellites_keep_their_angle),
      RUN(satellites_librate_as_debra_and_delp_say), RUN(loads_in_orbit_are_borne_by_the_gradient),
      RUN(gyrostats_in_orbit_tilt), RUN(particles_on_springs_obey_hill), RUN(booms_along_the_vertical_bend_faster),
      RUN_LONG(satellites_stay_in_their_steady_state), RUN(linear_models_answer_as_the_satellite_does),
      RUN(pins_hold_pendulums_above_a_center), RUN(orbits_that_are_none_are_refused))
