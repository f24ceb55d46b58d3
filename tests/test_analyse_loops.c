/* >>trim and >>linear: analysis of systems with loops; what is refused of systems. */
#include "analyse.h"

/* ---- a disk (4 kg, with the radii of gyration 0.15 m and 0.112 m on 0.6 m) that spins at the tip of a clamped
   shaft */

static fb_status linearized(fb_linear *linear, const fb_linear_desc *ports)
{
  return fb_system_linearize(&mechanism, part, &tree_work, linear, &tree_state, &drive, ports);
}

/* A trapezoid of rods in a plane that turns about x at Omega (flat: in itself, about a point e above): two of length L
   hang from the hub at y = -D/2 and D/2, one of
   length b between their ends; angles from x (down). */
typedef struct linkage {
  double D, L, b, m_L, m_b, g, Omega, e;
  int flat;
  double phi[3];    /* of the rods, the middle one last */
  double end[4][2]; /* hinges, then the ends below them */
} linkage;

static void linkage_place(linkage *at, double phi)
{
  double mid[2], d[2], rise;
  at->end[0][0] = at->end[1][0] = 0.0;
  at->end[0][1] = -0.5 * at->D;
  at->end[1][1] = 0.5 * at->D;
  at->end[2][0] = at->L * cos(phi);
  at->end[2][1] = -0.5 * at->D + at->L * sin(phi);
  { /* the circles of b about the one end and of L about the other hinge, the lower intersection */
    const double x = at->end[2][0], y = at->end[2][1] - 0.5 * at->D, s = x * x + y * y;
    const double along = 0.5 * (s + at->L * at->L - at->b * at->b) / s;
    rise = sqrt(at->L * at->L / s - along * along);
    mid[0] = along * x;
    mid[1] = along * y;
    d[0] = -rise * y;
    d[1] = rise * x;
  }
  at->end[3][0] = mid[0] + d[0];
  at->end[3][1] = mid[1] + d[1] + 0.5 * at->D;
  at->phi[0] = phi;
  at->phi[1] = atan2(at->end[3][1] - 0.5 * at->D, at->end[3][0]);
  at->phi[2] = atan2(at->end[3][1] - at->end[2][1], at->end[3][0] - at->end[2][0]);
}

/* int (z_0 + (z_1 - z_0) s)^2 dm of the rods, z a coordinate of their ends */
static double linkage_square(const linkage *at, const double z[4])
{
  return at->m_L / 3.0 * (z[0] * z[0] + z[0] * z[2] + z[2] * z[2] + z[1] * z[1] + z[1] * z[3] + z[3] * z[3]) +
         at->m_b / 3.0 * (z[2] * z[2] + z[2] * z[3] + z[3] * z[3]);
}

static double linkage_potential(linkage *at, double phi)
{
  double x[4], y[4];
  linkage_place(at, phi);
  for (int i = 0; i < 4; i++) {
    x[i] = at->end[i][0] + at->e;
    y[i] = at->end[i][1];
  }
  return -0.5 * at->g * (at->m_L + at->m_b) * (at->end[2][0] + at->end[3][0]) -
         0.5 * at->Omega * at->Omega * (linkage_square(at, y) + (at->flat ? linkage_square(at, x) : 0.0));
}

/* Inertia for phi', from the ends' motion. */
static double linkage_inertia(linkage *at, double phi)
{
  static const double weight[4] = {1.0 / 12.0, -2.0 / 3.0, 2.0 / 3.0, -1.0 / 12.0}, step[4] = {-2, -1, 1, 2};
  const double h = 3e-3;
  double v[2][4] = {{0}};
  for (int k = 0; k < 4; k++) {
    linkage_place(at, phi + step[k] * h);
    for (int i = 0; i < 8; i++) {
      v[i % 2][i / 2] += weight[k] / h * at->end[i / 2][i % 2];
    }
  }
  return linkage_square(at, v[0]) + linkage_square(at, v[1]);
}

/* E12.11, with E12.8 to E12.10: rods that close a loop, in a plane that spins: where they hang, by Newton's method from
   aside, and how they swing there, omega^2 = V''/M of the one angle there is; V, M from the rods' ends. The loop's
   rows say three things twice, its forces are not zero, and its potential is bent: D != b. With D = b it is a
   parallelogram with omega^2 = g (m_L + m_b) L/(2 m_L L^2/3 + m_b L^2) at rest. */
TEST(rods_in_a_loop_swing_as_one_pendulum)
{
  double largest = 0.0;
  for (int run = 0; run < 8; run++) {
    const int flat = run > 5; /* the joints' momenta are not zero */
    linkage at = {0.9,
                  0.7,
                  0.5 + 0.2 * (run % 6),
                  1.1,
                  0.8,
                  flat ? 0.0 : 9.81,
                  flat ? 5.0 : run % 2 ? 1.5 : 0.0,
                  flat ? 0.4 : 0.0,
                  flat,
                  {0},
                  {{0}}};
    const double h = 3e-3, guess = run < 2 ? 0.6 : 0.2;
    static fb_linear linear;
    double phi = guess, V[5], M, omega, ratio;
    fb_joint_desc *j;
    for (int step = 0; step < 30; step++) {
      for (int k = 0; k < 5; k++) {
        V[k] = linkage_potential(&at, phi + (k - 2) * h);
      }
      phi -= (V[0] - 8.0 * V[1] + 8.0 * V[3] - V[4]) / (12.0 * h) /
             ((-V[0] + 16.0 * V[1] - 30.0 * V[2] + 16.0 * V[3] - V[4]) / (12.0 * h * h));
    }
    M = linkage_inertia(&at, phi);
    omega = sqrt((-V[0] + 16.0 * V[1] - 30.0 * V[2] + 16.0 * V[3] - V[4]) / (12.0 * h * h) / M);
    if (run == 2) {
      FBT_NEAR_REL(omega,
                   sqrt(at.g * (at.m_L + at.m_b) * at.L / (2.0 * at.m_L * at.L * at.L / 3.0 + at.m_b * at.L * at.L)),
                   1e-8);
    }
    rotor(at.Omega);
    frame_turn(tree.joint[0].attitude, 0.0, flat ? 0.0 : pi / 2, 0.0);
    frame_turn(tree.joint[0].child_attitude, 0.0, flat ? 0.0 : pi / 2, 0.0);
    rigid_part(1, at.m_L, 0.5 * at.L, 0.0, at.m_L * at.L * at.L / 3.0, at.m_L * at.L * at.L / 3.0, at.g);
    rigid_part(2, at.m_b, 0.5 * at.b, 0.0, at.m_b * at.b * at.b / 3.0, at.m_b * at.b * at.b / 3.0, at.g);
    hang(1, 1, FB_JOINT_REVOLUTE, 0)->position[1] = -(fb_real)(0.5 * at.D);
    hang(2, 2, FB_JOINT_REVOLUTE, 1)->parent_node = 1;
    hang(3, 1, FB_JOINT_REVOLUTE, 0)->position[1] = (fb_real)(0.5 * at.D);
    tree.joint[1].position[0] = tree.joint[3].position[0] = (fb_real)at.e;
    tree.n_loop = 1;
    tree.method = run == 3 ? FB_METHOD_DENSE : FB_METHOD_RECURSIVE;
    j = &tree.loop[0];
    j->kind = FB_JOINT_REVOLUTE;
    j->parent = 2;
    j->parent_node = 1;
    j->child = 3;
    j->child_node = 1;
    linkage_place(&at, guess);
    start[1].value[0] = (fb_real)at.phi[0];
    start[2].value[0] = (fb_real)(at.phi[2] - at.phi[0]);
    start[3].value[0] = (fb_real)at.phi[1];
    build();
    trim_and_modes();
    linkage_place(&at, phi);
    FBT_NEAR_ABS(tree_state.link[1].x[0], phi, FBT_TOL(1e-9, 1e-4));
    FBT_NEAR_ABS(tree_state.link[3].x[0], at.phi[1], FBT_TOL(1e-9, 1e-4));
    FBT_INT_EQ(spectrum.n, 1);
    FBT_NEAR_REL(spectrum.im[0], omega, FBT_TOL(1e-8, 2e-3));
    FBT_NEAR_ABS(spectrum.re[0], 0.0, FBT_TOL(1e-9, 1e-2));
    largest = fmax(largest, fabs((double)spectrum.im[0] / omega - 1.0));
    linkage_place(&at, phi + h);
    ratio = at.phi[1];
    linkage_place(&at, phi - h);
    ratio = (ratio - at.phi[1]) / (2.0 * h); /* the shape has all joints: (phi, phi_b - phi, phi_2) */
    {
      const number first = {(double)spectrum.shape_re[0], (double)spectrum.shape_im[0]};
      const number third = {(double)spectrum.shape_re[2], (double)spectrum.shape_im[2]};
      const number miss = plus(third, -ratio, first);
      FBT_BELOW(hypot(miss.re, miss.im) / hypot(first.re, first.im), FBT_TOL(1e-4, 1e-3));
    }
    FBT_INT_EQ(linearized(&linear, NULL), FB_OK);
    FBT_INT_EQ(linear.n, 2);
    FBT_INT_EQ(linear.n_free, 1);
  }
  tree.joint[1].mode[0] = FB_AXIS_PRESCRIBED;
  drive.drive[1].value[0] = start[1].value[0];
  build();
  {
    const fb_system_state before = tree_state;
    fb_status status;
    drive.drive[1].value[0] = -FB_R(1.5); /* the others do not reach it there */
    status = fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive);
    FBT_TRUE(status == FB_ERR_CONTRADICTION || status == FB_ERR_SINGULAR);
    FBT_INT_EQ(tree_work.system.joint, mechanism.n_body);
    FBT_TRUE(memcmp(&before, &tree_state, sizeof before) == 0);
  }
  fbt_figure("rods in a loop that spins, frequency", "potential of one angle", largest);
}

/* E12.9, E12.11: the linear model of a loop that spins, integrated, answers as the system does: dependent coordinates,
   which have momenta, are among inputs and outputs, and the base moves freely or as it is told. */
TEST(linear_models_answer_as_the_loop_does)
{
  static const fb_port out[8] = {
      {FB_PORT_COORDINATE, 1, 0, 0, FB_AXES_BODY},   {FB_PORT_SPEED, 3, 0, 0, FB_AXES_BODY},
      {FB_PORT_COORDINATE, 2, 0, 0, FB_AXES_BODY},   {FB_PORT_RATE, 2, 1, 2, FB_AXES_BODY},
      {FB_PORT_ACCELERATION, 2, 1, 0, FB_AXES_BODY}, {FB_PORT_ACCELERATION, 3, 1, 1, FB_AXES_BODY},
      {FB_PORT_DISPLACEMENT, 1, 1, 1, FB_AXES_BODY}, {FB_PORT_ROTATION, 3, 1, 2, FB_AXES_BODY}};
  const double small = FBT_TOL(1e-3, 3e-2);
  for (int base = 0; base < 2; base++) {
    const fb_port in[5] = {{base ? FB_PORT_BASE_RATE : FB_PORT_TORQUE, 0, 0, 2, FB_AXES_BODY},
                           {FB_PORT_DRIVE, 3, 0, 0, FB_AXES_BODY},
                           {FB_PORT_FORCE, 2, 1, 0, FB_AXES_BODY},
                           {FB_PORT_DRIVE, 2, 0, 0, FB_AXES_BODY},
                           {base ? FB_PORT_BASE_VELOCITY : FB_PORT_FORCE, 0, 0, 1, FB_AXES_BODY}};
    const double size[5] = {base ? 0.05 * small : small, small, small, small, small};
    const int n_free = base ? 1 : 7;
    boom_loop(base ? FB_AXIS_PRESCRIBED : FB_AXIS_FREE);
    build();
    FBT_BELOW(answers_apart(in, out, size, 3 + n_free, n_free), FBT_TOL(5e-4, 1.5e-2));
  }
}

/* E12.11: a cantilever whose tip a ball joint holds in place has no joint that could follow, only modes: the
   frequencies are the roots of sum psi_a(tip)^2/(omega_a^2 - omega^2) = 0 in either plane, one less than modes each. */
TEST(held_tips_take_a_mode_away)
{
  fb_joint_desc *const hold = &tree.loop[0];
  fresh();
  flexible_part(0, 2.0, 3, FB_BASE_PRESCRIBED, FB_EFFECTS_LINEAR);
  hang(0, 0, FB_JOINT_RIGID, FB_GROUND);
  tree.n_loop = 1;
  hold->kind = FB_JOINT_SPHERICAL;
  hold->parent = FB_GROUND;
  hold->position[0] = FB_R(2.0);
  hold->child_node = 1;
  build();
  trim_and_modes();
  FBT_INT_EQ(spectrum.n, 4);
  for (int k = 0; k < spectrum.n; k++) {
    const double square = (double)spectrum.im[k] * (double)spectrum.im[k];
    double sum[3] = {0}, size[3] = {0};
    for (int a = 0; a < 6; a++) {
      for (int axis = 1; axis < 3; axis++) {
        const double psi = (double)part[0].node[1].psi[3 * a + axis];
        const double term = psi * psi / ((double)shape.K[7 * a] - square);
        sum[axis] += term;
        size[axis] += fabs(term);
      }
    }
    FBT_BELOW(fmin(fabs(sum[1] / size[1]), fabs(sum[2] / size[2])), FBT_TOL(1e-9, 1e-3));
    FBT_NEAR_ABS(spectrum.re[k], 0.0, FBT_TOL(1e-9, 1e-2));
    for (int axis = 1; axis < 3; axis++) { /* the shape does not move the tip */
      double tip = 0.0, most = 0.0;
      for (int a = 0; a < 6; a++) {
        const double q = (double)spectrum.shape_re[6 * k + a] + (double)spectrum.shape_im[6 * k + a];
        tip += (double)part[0].node[1].psi[3 * a + axis] * q;
        most += fabs((double)part[0].node[1].psi[3 * a + axis] * q);
      }
      FBT_NEAR_ABS(tip, 0.0, FBT_TOL(1e-10, 1e-4) * (most + 1.0));
    }
  }
}

static int no_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  (void)row, (void)capacity, (void)pose, (void)t, (void)user;
  return 0;
}

/* Interface: the same of systems: what is missing, ports that are not there, what has no linear model of this kind,
   what cannot rest; nothing given is changed. */
TEST(analysis_of_systems_refuses_bad_input)
{
  static const struct {
    fb_port port;
    int input;
    fb_status status;
  } wrong[] = {{{FB_PORT_DRIVE, 0, 0, 0, FB_AXES_BODY}, 1, FB_ERR_VALUE},         /* a free joint has no motor */
               {{FB_PORT_DRIVE, 4, 0, 0, FB_AXES_BODY}, 1, FB_ERR_CAPACITY},      /* no such body */
               {{FB_PORT_DRIVE, -1, 0, 0, FB_AXES_BODY}, 1, FB_ERR_CAPACITY},     /* the ground */
               {{FB_PORT_DRIVE, 1, 0, 1, FB_AXES_BODY}, 1, FB_ERR_CAPACITY},      /* no such axis */
               {{FB_PORT_DRIVE, 1, 0, 0, FB_AXES_BODY}, 0, FB_ERR_VALUE},         /* no output */
               {{FB_PORT_SPEED, 1, 0, 0, FB_AXES_BODY}, 1, FB_ERR_VALUE},         /* no input */
               {{FB_PORT_SPEED, 1, 0, 3, FB_AXES_BODY}, 0, FB_ERR_VALUE},         /* no axis at all */
               {{FB_PORT_COORDINATE, 1, 0, 1, FB_AXES_BODY}, 0, FB_ERR_CAPACITY}, /* no such axis */
               {{FB_PORT_BASE_RATE, 1, 0, 0, FB_AXES_BODY}, 1, FB_ERR_VALUE},     /* not prescribed */
               {{FB_PORT_FORCE, 0, 7, 0, FB_AXES_BODY}, 1, FB_ERR_CAPACITY},      /* no such node */
               {{FB_PORT_RATE, 3, 9, 0, FB_AXES_BODY}, 0, FB_ERR_CAPACITY},       /* no such node */
               {{FB_PORT_COUNT, 1, 0, 0, FB_AXES_BODY}, 0, FB_ERR_VALUE}};        /* no such kind */
  static fb_linear linear, linear_before;
  static fb_spectrum before_spectrum;
  static fb_system_state before;
  static fb_linear_desc ports;
  spinner(FB_AXIS_PRESCRIBED, 0.8);
  tree.joint[2].mode[0] = FB_AXIS_LOCKED;
  build();
  memset(&linear, 0x5a, sizeof linear);
  linear_before = linear;
  before_spectrum = spectrum;
  before = tree_state;
  FBT_INT_EQ(fb_system_trim(NULL, part, &tree_state, &tree_work, &drive), FB_ERR_NULL);
  FBT_INT_EQ(fb_system_trim(&mechanism, NULL, &tree_state, &tree_work, &drive), FB_ERR_NULL);
  FBT_INT_EQ(fb_system_trim(&mechanism, part, NULL, &tree_work, &drive), FB_ERR_NULL);
  FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, NULL, &drive), FB_ERR_NULL);
  FBT_INT_EQ(fb_system_linearize(&mechanism, part, &tree_work, NULL, &tree_state, &drive, NULL), FB_ERR_NULL);
  FBT_INT_EQ(fb_system_linearize(&mechanism, part, NULL, &linear, &tree_state, &drive, NULL), FB_ERR_NULL);
  FBT_INT_EQ(fb_system_linearize(&mechanism, part, &tree_work, &linear, NULL, &drive, NULL), FB_ERR_NULL);
  FBT_INT_EQ(fb_system_spectrum_solve(&mechanism, part, &tree_work, NULL, &tree_state, &drive), FB_ERR_NULL);
  FBT_INT_EQ(fb_system_spectrum_solve(&mechanism, part, NULL, &spectrum, &tree_state, &drive), FB_ERR_NULL);
  FBT_INT_EQ(fb_system_spectrum_solve(NULL, part, &tree_work, &spectrum, &tree_state, &drive), FB_ERR_NULL);
  for (int k = 0; k < FBT_COUNT(wrong); k++) {
    memset(&ports, 0, sizeof ports);
    ports.n_in = wrong[k].input;
    ports.n_out = !wrong[k].input;
    ports.in[0] = ports.out[0] = wrong[k].port;
    FBT_INT_EQ(linearized(&linear, &ports), wrong[k].status);
  }
  ports.n_in = 1;
  ports.n_out = 0;
  ports.in[0].kind = FB_PORT_DRIVE;
  ports.in[0].body = 2; /* its axis is locked */
  FBT_INT_EQ(linearized(&linear, &ports), FB_ERR_VALUE);
  ports.in[0].kind = FB_PORT_FORCE;
  drive.n_load = FB_MAX_LOADS; /* no room for one more */
  FBT_INT_EQ(linearized(&linear, &ports), FB_ERR_CAPACITY);
  drive.n_load = 0;
  ports.n_out = FB_MAX_PORTS + 1;
  FBT_INT_EQ(linearized(&linear, &ports), FB_ERR_CAPACITY);
  drive.drive[1].torque[0] = (fb_real)NAN;
  FBT_INT_EQ(linearized(&linear, NULL), FB_ERR_NOT_FINITE);
  FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), FB_ERR_NOT_FINITE);
  drive.drive[1].torque[0] = FB_R(0.0);
  drive.drive[0].rate[5] = FB_R(300.0); /* the blades bend beyond what they may */
  drive.n_load = 1;
  drive.load[0].body = drive.load[0].load.node = 1;
  drive.load[0].load.axes = FB_AXES_BODY;
  drive.load[0].load.force[2] = FB_R(1e5);
  FBT_TRUE(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive) != FB_OK);
  drive.n_load = 0;
  FBT_TRUE(memcmp(&before, &tree_state, sizeof before) == 0);
  tree_state.link[1].q[0] = (fb_real)NAN;
  FBT_INT_EQ(linearized(&linear, NULL), FB_ERR_NOT_FINITE);
  FBT_INT_EQ(fb_system_spectrum_solve(&mechanism, part, &tree_work, &spectrum, &tree_state, &drive), FB_ERR_NOT_FINITE);
  spinner(FB_AXIS_LOCKED, 0.0);
  memset(&ports, 0, sizeof ports);
  ports.n_in = 1;
  ports.in[0].kind = FB_PORT_BASE_RATE; /* of a free joint, but locked */
  build();
  FBT_INT_EQ(linearized(&linear, &ports), FB_ERR_VALUE);
  tree.joint[1].stiffness[0] = FB_R(0.0); /* the blade swings freely in its plane */
  build();
  before = tree_state;
  FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), FB_ERR_SINGULAR);
  FBT_TRUE(memcmp(&before, &tree_state, sizeof before) == 0);
  tree.joint[1].stiffness[0] = FB_R(30.0);
  build();
  drive.rows = no_rows;
  tree_work.system.joint = 2; /* from another failure */
  FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), FB_ERR_UNSUPPORTED);
  FBT_INT_EQ(tree_work.system.joint, -1);
  FBT_INT_EQ(linearized(&linear, NULL), FB_ERR_UNSUPPORTED);
  FBT_INT_EQ(fb_system_spectrum_solve(&mechanism, part, &tree_work, &spectrum, &tree_state, &drive),
             FB_ERR_UNSUPPORTED);
  fresh();
  flexible_part(0, 2.0, 5, FB_BASE_PRESCRIBED, FB_EFFECTS_LINEAR);
  for (int k = 0; k < FB_MAX_BODIES; k++) {
    hang(k, 0, FB_JOINT_REVOLUTE, FB_GROUND);
  }
  build();
  FBT_TRUE(FB_MAX_BODIES * 11 > FB_MAX_LINEAR / 2);
  FBT_INT_EQ(linearized(&linear, NULL), FB_ERR_CAPACITY);
  FBT_TRUE(memcmp(&linear, &linear_before, sizeof linear) == 0);
  FBT_TRUE(memcmp(&spectrum, &before_spectrum, sizeof spectrum) == 0);
}

SUITE(analyse_loops, RUN(rods_in_a_loop_swing_as_one_pendulum), RUN(linear_models_answer_as_the_loop_does),
      RUN(held_tips_take_a_mode_away), RUN(analysis_of_systems_refuses_bad_input))
