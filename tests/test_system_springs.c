/* >>system: springs, dampers and actuators between points; forces as functions of the state. */
#include "system.h"

static fb_system_state kept, rate;
static fb_system_analyse_work analyse_work;
static fb_spectrum spectrum;

/* A spring from a node to a node. */
static fb_spring *spring_between(int a, int node_a, int b, int node_b, double stiffness, double length, double damping)
{
  fb_spring *s = &desc.spring[desc.n_spring++];
  s->body[0] = a;
  s->node[0] = node_a;
  s->body[1] = b;
  s->node[1] = node_b;
  s->stiffness = (fb_real)stiffness;
  s->length = (fb_real)length;
  s->damping = (fb_real)damping;
  return s;
}

/* The tree of all joints with springs between rigid and flexible bodies, one of them within a body; to_ground: one
   more. */
static void sprung_tree(unsigned effects, int damped, int to_ground)
{
  tree(effects, damped);
  (void)spring_between(0, 1, 3, 1, 20.0, 0.4, damped ? 0.5 : 0.0);
  (void)spring_between(2, 1, 4, 0, 8.0, 0.0, 0.0);
  (void)spring_between(1, 1, 1, 0, 5.0, 1.2, damped ? 0.2 : 0.0);
  for (int j = 0; j < 3; j++) {
    for (int i = 0; i < 3; i++) {
      desc.spring[j].position[0][i] = (fb_real)(0.2 * fbt_random());
      desc.spring[j].position[1][i] = (fb_real)(0.2 * fbt_random());
    }
  }
  if (to_ground) {
    fb_spring *s = spring_between(FB_GROUND, 0, 5, 1, 12.0, 0.5, damped ? 0.3 : 0.0);
    s->position[0][1] = FB_R(2.0);
  }
}

/* Rate of the energy along the rates of the state; those of momentum and angular momentum are below tol. */
static double energy_slope(double tol)
{
  static const double weight[5] = {1.0 / 12, -2.0 / 3, 0, 2.0 / 3, -1.0 / 12};
  const double h = FBT_TOL(1e-4, 1e-2);
  double slope = 0.0, force[6] = {0};
  fb_momentum at;
  memset(&rate, 0, sizeof rate);
  FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, &input), FB_OK);
  for (int side = -2; side <= 2; side++) {
    moved(&kept, &state, &rate, side * h);
    slope += weight[side + 2] / h * energy_of(&kept);
    FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &at, &kept, &input), FB_OK);
    for (int i = 0; i < 3; i++) {
      force[i] += weight[side + 2] / h * (double)at.linear[i];
      force[3 + i] += weight[side + 2] / h * (double)at.angular[i];
    }
  }
  for (int i = 0; i < 6; i++) {
    FBT_BELOW(fabs(force[i]), tol);
  }
  return slope;
}

/* E9.26: springs are internal: they change neither energy nor momentum, whatever the effects, by either method and with joints as loops;
   dampers take c l_dot^2, actuators give -pull l_dot, a spring to the ground keeps the energy alone. */
TEST(springs_between_points_balance_energy)
{
  for (int run = 0; run < 18; run++) {
    const int damped = run / 3 % 3 == 1, to_ground = run / 3 % 3 == 2;
    double power = 0.0;
    sprung_tree(run < 9 ? FB_EFFECTS_FULL : FB_EFFECTS_LARGE, damped, to_ground);
    init(run % 3);
    for (int j = 0; j < desc.n_body + desc.n_loop; j++) { /* joints are without dampers */
      memset(mechanism.joint[j].damping, 0, sizeof mechanism.joint[j].damping);
    }
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    input.pull[0] = damped ? FB_R(3.0) : FB_R(0.0);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    for (int j = 0; j < desc.n_spring; j++) {
      const double speed = (double)motion.spring[j].rate;
      power -= (double)desc.spring[j].damping * speed * speed + (double)input.pull[j] * speed;
    }
    if (run % 3 != AS_LOOPS) { /* of loops the rates do not hold the momenta to rounding */
      FBT_NEAR_ABS(energy_slope(to_ground ? 1e3 : FBT_TOL(1e-9, 1e-1)), power, FBT_TOL(1e-8, 2e-1));
    }
    power += damped ? (double)(input.pull[0] * motion.spring[0].rate) : 0.0; /* of what is lost */
    FBT_TRUE(damped == (power < -1e-3));
    FBT_NEAR_REL(motion.power, -input.pull[0] * motion.spring[0].rate, FBT_TOL(1e-10, 1e-3));
    FBT_NEAR_REL(rate.motor_work, motion.power, FBT_TOL(1e-10, 1e-2));
  }
}

/* E9.26 in the three forms: the same motion. Lengths are those between the points. */
TEST(springs_between_points_act_alike_in_every_form)
{
  static fb_system_motion first;
  for (int form = 0; form < FORMS; form++) {
    sprung_tree(FB_EFFECTS_FULL, 1, 1);
    init(form);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    input.pull[2] = FB_R(4.0);
    motion_of(&motion, &state);
    first = form == 0 ? motion : first;
    FBT_BELOW(motion_difference(&motion, &first), FBT_TOL(1e-11, 1e-3));
    for (int j = 0; j < desc.n_spring; j++) {
      double x[2][3] = {{0}}, v[2][3] = {{0}}, length = 0.0, speed = 0.0;
      for (int side = 0; side < 2; side++) {
        const int k = desc.spring[j].body[side];
        const fb_real *const own = desc.spring[j].position[side];
        fb_node_motion at;
        fb_real R[9], r[3], spin[3];
        memset(&at, 0, sizeof at);
        at.quat[0] = FB_R(1.0);
        if (k >= 0) {
          FBT_INT_EQ(fb_body_node_motion_eval(&model[desc.model[k]], &at, &motion.pose[k], &motion.motion[k],
                                              desc.spring[j].node[side]),
                     FB_OK);
        }
        fb_quat_to_mat33(R, at.quat);
        fb_mat33_mul_vec3(r, R, own);
        fb_vec3_cross(spin, at.angular_rate, r);
        for (int i = 0; i < 3; i++) {
          x[side][i] = (double)(at.position[i] + r[i]);
          v[side][i] = (double)(at.velocity[i] + spin[i]);
        }
      }
      length = sqrt(pow(x[1][0] - x[0][0], 2) + pow(x[1][1] - x[0][1], 2) + pow(x[1][2] - x[0][2], 2));
      for (int i = 0; i < 3; i++) {
        speed += (v[1][i] - v[0][i]) * (x[1][i] - x[0][i]) / length;
      }
      FBT_NEAR_ABS(motion.spring[j].length, length, FBT_TOL(1e-13, 1e-5));
      FBT_NEAR_ABS(motion.spring[j].rate, speed, FBT_TOL(1e-12, 1e-4));
      FBT_NEAR_ABS(motion.spring[j].tension,
                   (double)desc.spring[j].stiffness * (length - (double)desc.spring[j].length) +
                       (double)desc.spring[j].damping * speed + (double)input.pull[j],
                   FBT_TOL(1e-11, 1e-3));
    }
  }
}

/* ---- the mechanism of Andrews */

enum { CRANK, ROD, PLATE, ARM_G, LINK_G, ARM_H, LINK_H };

/* A planar bar whose mass center is at (x, y), with node 1 at (fx, fy) and node 2 at (gx, gy). */
static void bar(int k, double mass, double inertia, double x, double y, double fx, double fy, double gx, double gy)
{
  const fb_real center[3] = {(fb_real)x, (fb_real)y, 0},
                J[6] = {(fb_real)inertia, (fb_real)inertia, (fb_real)inertia, 0, 0, 0};
  const fb_real far_end[3] = {(fb_real)fx, (fb_real)fy, 0}, other[3] = {(fb_real)gx, (fb_real)gy, 0};
  fb_body_desc d;
  int node;
  memset(&d, 0, sizeof d);
  d.base = FB_BASE_PRESCRIBED;
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)mass, center, J), FB_OK);
  FBT_INT_EQ(fb_shape_add_node(&shape, &node, far_end, NULL, NULL), FB_OK);
  FBT_INT_EQ(fb_shape_add_node(&shape, &node, other, NULL, NULL), FB_OK);
  FBT_INT_EQ(fb_body_init(&model[k], &body_work, &shape, &d), FB_OK);
}

static void hinge_at(int k, int parent, int node, double x, double y, double angle)
{
  hang(k, k, FB_JOINT_REVOLUTE, parent, node);
  desc.joint[k].position[0] = (fb_real)x;
  desc.joint[k].position[1] = (fb_real)y;
  start[k].value[0] = (fb_real)angle;
}

/* E9.7 to E9.15, E9.26: the seven-body squeezer of Andrews, driven by a constant torque, against the published solution
   at 0.03 s ([HW] VII.7; Mazzia and Magherini, Test Set for IVP Solvers, 2008), which an integration of Lagrange's
   equations in the seven angles with tolerance 1e-13 confirms to 6e-12 of its largest. Angles of the text, by joints:
   crank beta, rod Theta, plate gamma, ARM_G delta, LINK_G Phi, ARM_H epsilon, LINK_H Omega. */
TEST(andrews_squeezer_moves_as_published)
{
  static const double beta = -0.0617138900142764497, gamma = 0.455279819163070380, phi = 0.222668390165885885,
                      delta = 0.487364979543842550, epsilon = 1.23054744454982119;
  static const double published[7] = {15.81077119629904,  -15.75637105984298, 0.04082224013073101, -0.5347301163226948,
                                      0.5244099658805304, 0.5347301163226948, 1.048080741042263};
  static const int joint[7] = {CRANK, ROD, PLATE, LINK_G, ARM_G, LINK_H, ARM_H};
  const double T = 0.03;
  const int n = (int)FBT_LONG(FBT_TOL(3000, 1500), 1500);
  double worst = 0.0;
  fresh();
  bar(CRANK, 0.04325, 2.194e-6, 0.92e-3, 0, 7e-3, 0, 0, 0);                     /* along x, to F */
  bar(ROD, 0.00365, 4.410e-7, -11.5e-3, 0, -28e-3, 0, 0, 0);                    /* back along x, to E */
  bar(PLATE, 0.02373, 5.255e-6, 10.43e-3, -18.74e-3, 0, -35e-3, 20e-3, -18e-3); /* from B to E, and D */
  bar(ARM_G, 0.07050, 1.169e-5, 23.08e-3, 9.16e-3, 40e-3, 0, 0, 0);             /* from A to G */
  bar(LINK_G, 0.00706, 5.667e-7, 0, -5.79e-3, 0, -20e-3, 0, 0);                 /* from G to E */
  bar(ARM_H, 0.05498, 1.912e-5, -4.49e-3, -12.28e-3, 0, -40e-3, 0, 0);          /* from A to H */
  bar(LINK_H, 0.00706, 5.667e-7, 5.79e-3, 0, 20e-3, 0, 0, 0);                   /* from H to E */
  hinge_at(CRANK, FB_GROUND, 0, 0, 0, beta);
  hinge_at(ROD, CRANK, 1, 0, 0, 0.0);
  hinge_at(PLATE, FB_GROUND, 0, -0.03635, 0.03273, gamma);
  hinge_at(ARM_G, FB_GROUND, 0, -0.06934, -0.00227, delta);
  hinge_at(ARM_H, FB_GROUND, 0, -0.06934, -0.00227, epsilon);
  hinge_at(LINK_G, ARM_G, 1, 0, 0, phi);
  hinge_at(LINK_H, ARM_H, 1, 0, 0, -phi);
  (void)close_loop(FB_JOINT_REVOLUTE, PLATE, 1, ROD, 1);
  (void)close_loop(FB_JOINT_REVOLUTE, PLATE, 1, LINK_G, 1);
  (void)close_loop(FB_JOINT_REVOLUTE, PLATE, 1, LINK_H, 1);
  (void)spring_between(PLATE, 2, FB_GROUND, 0, 4530.0, 0.07785, 0.0);
  desc.spring[0].position[1][0] = FB_R(0.014);
  desc.spring[0].position[1][1] = FB_R(0.072);
  input.drive[CRANK].torque[0] = FB_R(0.033);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
  FBT_NEAR_REL(motion.joint[CRANK].acceleration[0], 14222.4439199541, FBT_TOL(1e-9, 2e-3)); /* as published, t = 0 */
  FBT_NEAR_REL(motion.joint[ROD].acceleration[0], -10666.8329399656, FBT_TOL(1e-9, 2e-3));
  for (int step = 0; step < n; step++) {
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, (fb_real)(T / n)), FB_OK);
  }
  for (int k = 0; k < 7; k++) {
    worst = fmax(worst, fabs((double)state.link[joint[k]].x[0] - published[k]));
  }
  FBT_BELOW(worst, FBT_TOL(1e-8, 2e-2));
  fbt_figure("Andrews' squeezer, seven angles after 0.03 s [rad]", "published", worst);
}

/* ---- limits of the step */

/* A mass of 2 kg on a free joint, or (shuttle) on a slide along x, between two springs to the ground along y. */
static void mass_between(int shuttle, double stiffness, double length, double damping)
{
  fresh();
  rigid(&model[0], 2.0, 0, 0, 0, 1.0, 1.0, 1.0);
  hang(0, 0, shuttle ? FB_JOINT_PRISMATIC : FB_JOINT_FREE, FB_GROUND, 0);
  for (int j = 0; j < 2; j++) {
    fb_spring *s = spring_between(FB_GROUND, 0, 0, 0, stiffness, length, damping);
    s->position[0][1] = FB_R(1.0) - FB_R(2.0) * (fb_real)j;
  }
  if (shuttle) {
    desc.joint[0].axis[0] = FB_R(1.0);
  }
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
}

/* E11.42: the limit by springs along the motion (2 k/m), across it (tension over length, of springs and actuators) and
   by their dampers (2 c/m), at the present state; E12.10: the frequencies themselves. */
TEST(springs_between_points_bound_the_step)
{
  const double radius = 2.785;
  fb_system_limit limit;
  for (int run = 0; run < 4; run++) {
    const double k = 800.0, length = run == 2 ? 0.25 : 1.0, c = run == 3 ? 40.0 : 0.0;
    const double mobility = 0.5;
    double bound, across;
    mass_between(run == 1 || run == 2, k, length, c);
    input.pull[0] = input.pull[1] = run == 1 ? FB_R(300.0) : FB_R(0.0);
    across = (run == 1 ? 300.0 : k * (1.0 - length)) * mobility;
    bound = run == 1 || run == 2 ? 2.0 * across : 2.0 * k * mobility;
    bound = c * mobility + sqrt(pow(c * mobility, 2.0) + bound);
    FBT_INT_EQ(fb_system_limit_eval(&mechanism, model, &work, &limit, &state, &input), FB_OK);
    FBT_NEAR_REL(limit.rk4, radius / bound, FBT_TOL(1e-6, 1e-4));
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(1.01) * limit.rk4),
               FB_ERR_STEP);
    FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, FB_R(1.01) * limit.sdirk, 0),
               FB_ERR_STEP);
    start[0].value[0] = FB_R(1e-3);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    for (int step = 0; step < 2000; step++) { /* stable within it */
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(0.97) * limit.rk4),
                 FB_OK);
    }
    FBT_BELOW(fabs((double)state.link[0].x[0]), 1.01e-3);
    if (run < 3) {
      start[0].value[0] = FB_R(0.0);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
      FBT_INT_EQ(fb_system_spectrum_solve(&mechanism, model, &analyse_work, &spectrum, &state, &input), FB_OK);
      FBT_NEAR_REL(spectrum.im[spectrum.n - 1], bound, FBT_TOL(1e-6, 1e-2));
    }
  }
}

/* E12.9: actuators as inputs and lengths as outputs of linear models: of a mass between two springs. */
TEST(actuators_and_lengths_are_channels_of_linear_models)
{
  static fb_linear linear;
  fb_linear_desc ports = {2,
                          3,
                          {{FB_PORT_PULL, 0, 0, 0, FB_AXES_BODY}, {FB_PORT_PULL, 1, 0, 0, FB_AXES_BODY}},
                          {{FB_PORT_LENGTH, 0, 0, 0, FB_AXES_BODY},
                           {FB_PORT_LENGTH, 1, 0, 0, FB_AXES_BODY},
                           {FB_PORT_SPEED, 0, 0, 1, FB_AXES_BODY}}};
  mass_between(0, 800.0, 1.0, 3.0);
  FBT_INT_EQ(fb_system_linearize(&mechanism, model, &analyse_work, &linear, &state, &input, &ports), FB_OK);
  FBT_INT_EQ(linear.n, 12);
  for (int j = 0; j < 2; j++) {
    const double sign = j ? -1.0 : 1.0;
    for (int i = 0; i < 12; i++) { /* y and its momentum: 1 and 7 */
      FBT_NEAR_ABS(linear.B[i * 2 + j], i == 7 ? sign : 0.0, FBT_TOL(1e-9, 1e-4));
      FBT_NEAR_ABS(linear.C[j * 12 + i], i == 1 ? -sign : 0.0, FBT_TOL(1e-9, 1e-3));
    }
  }
  FBT_NEAR_REL(linear.A[7 * 12 + 1], -1600.0, FBT_TOL(1e-9, 1e-3));
  FBT_NEAR_REL(linear.A[7 * 12 + 7], -3.0, FBT_TOL(1e-9, 1e-3));
  ports.in[1].body = ports.out[1].body = 2; /* there are two springs */
  FBT_INT_EQ(fb_system_linearize(&mechanism, model, &analyse_work, &linear, &state, &input, &ports), FB_ERR_CAPACITY);
  ports.in[1].kind = FB_PORT_LENGTH;
  ports.in[1].body = 1;
  FBT_INT_EQ(fb_system_linearize(&mechanism, model, &analyse_work, &linear, &state, &input, &ports), FB_ERR_VALUE);
}

/* E11.42: the limit is that of the pose: a slider that a rod drives is light at the dead center and heavy beside it. */
TEST(springs_bound_the_step_where_they_are)
{
  fb_system_limit limit[2];
  for (int run = 0; run < 2; run++) {
    fresh();
    rigid(&model[0], 1.0, 0.5, 0, 0, 1e-3, 1.0 / 12.0, 1.0 / 12.0);
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    (void)spring_between(0, 1, FB_GROUND, 0, 500.0, 1.0, 0.0);
    desc.spring[0].position[1][0] = FB_R(2.0);
    init(FB_METHOD_RECURSIVE);
    start[0].value[0] = run ? FB_R(0.0) : (fb_real)(pi / 4.0); /* along the rod the spring moves nothing */
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_limit_eval(&mechanism, model, &work, &limit[run], &state, &input), FB_OK);
  }
  FBT_BELOW(10.0 * (double)limit[0].rk4, (double)limit[1].rk4);
  { /* the tip moves by 3/kg along its circle */
    const double l = sqrt(5.0 - 4.0 * cos(pi / 4.0)), along = 2.0 * sin(pi / 4.0) / l;
    const double k = 500.0 * (along * along + (1.0 - 1.0 / l) * (1.0 - along * along));
    FBT_NEAR_REL(limit[0].rk4, 2.785 / sqrt(3.0 * k), FBT_TOL(1e-6, 1e-4));
  }
}

#if FB_WITH_LARGE_DEFLECTION
/* E11.42 at the tip of a bending body on which nothing hangs: the speeds of its modes are part of the mobility, as where
   its modes are those of curvature, whose speeds rates always know. */
TEST(springs_on_bending_tips_bound_the_step)
{
  fb_system_limit at[2];
  for (int large = 0; large < 2; large++) {
    fresh();
    rigid(&model[0], 3.0, 0.1, 0, 0, 0.3, 0.4, 0.5);
    flexible(&model[1], 2, 1, 1, large ? FB_EFFECTS_LARGE : FB_EFFECTS_FULL);
    hang(0, 0, FB_JOINT_RIGID, FB_GROUND, 0);
    hang(1, 1, FB_JOINT_RIGID, 0, 0);
    desc.n_spring = 1;
    desc.spring[0].body[0] = FB_GROUND;
    desc.spring[0].position[0][0] = FB_R(1.0);
    desc.spring[0].position[0][1] = -FB_R(1.0);
    desc.spring[0].body[1] = 1;
    desc.spring[0].node[1] = 1;
    desc.spring[0].length = FB_R(1.0);
    desc.spring[0].stiffness = FB_R(1e5);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_limit_eval(&mechanism, model, &work, &at[large], &state, &input), FB_OK);
    FBT_INT_EQ(fb_system_spectrum_solve(&mechanism, model, &analyse_work, &spectrum, &state, &input), FB_OK);
    {
      double most = 0;
      for (int i = 0; i < spectrum.n; i++) {
        most = fmax(most, hypot((double)spectrum.re[i], (double)spectrum.im[i]));
      }
      FBT_BELOW(most * (double)at[large].rk4, 2.83);
      FBT_TRUE(most * (double)at[large].rk4 > 1.0);
    }
  }
}
#define ON_TIPS , RUN(springs_on_bending_tips_bound_the_step)
#else
#define ON_TIPS
#endif

/* E9.26: points that meet are refused where the spring has no direction there, and taken where it needs none. */
TEST(springs_whose_points_meet_are_refused)
{
  for (int run = 0; run < 4; run++) {
    fresh();
    rigid(&model[0], 2.0, 0, 0, 0, 1.0, 1.0, 1.0);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    (void)spring_between(FB_GROUND, 0, 0, 0, 50.0, run == 1 ? 0.1 : 0.0, run == 2 ? 1.0 : 0.0);
    input.pull[0] = run == 3 ? FB_R(1.0) : FB_R(0.0);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    kept = state;
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(0.01)),
               run ? FB_ERR_RANGE : FB_OK);
    FBT_TRUE(!run || memcmp(&kept, &state, sizeof state) == 0);
    start[0].speed[0] = FB_R(1.0);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    for (int step = 0; step < 1000 && run == 0; step++) { /* through the point itself, 5 rad/s */
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(0.002)), FB_OK);
    }
    FBT_NEAR_ABS(state.link[0].x[0] + state.link[0].lost_x[0], run ? 0.0 : 0.2 * sin(10.0), FBT_TOL(1e-8, 1e-4));
  }
}

/* E9.26: of springs refused are what they cannot be. */
TEST(springs_are_checked)
{
  const fb_real bad[] = {-FB_R(1.0), FB_HUGE * FB_R(10.0), (fb_real)NAN};
  for (int field = 0; field < 3; field++) {
    for (int i = 0; i < 3; i++) {
      tree(FB_EFFECTS_SPIN, 0);
      *(field == 0   ? &spring_between(0, 0, 2, 0, 1.0, 1.0, 1.0)->stiffness
        : field == 1 ? &spring_between(0, 0, 2, 0, 1.0, 1.0, 1.0)->length
                     : &spring_between(0, 0, 2, 0, 1.0, 1.0, 1.0)->damping) = bad[i];
      FBT_TRUE(fb_system_init(&mechanism, &work, model, &desc, 3) < 0);
    }
  }
  for (int run = 0; run < 6; run++) {
    static const int body[6][2] = {{-1, -1}, {-2, 0}, {0, 8}, {0, 1}, {0, 1}, {-1, 1}},
                     node[6][2] = {{0, 0}, {0, 0}, {0, 0}, {0, 3}, {-1, 0}, {1, 0}};
    tree(FB_EFFECTS_SPIN, 0);
    (void)spring_between(body[run][0], node[run][0], body[run][1], node[run][1], 1.0, 1.0, 0.0);
    FBT_INT_EQ(fb_system_init(&mechanism, &work, model, &desc, 3), run < 3 ? FB_ERR_VALUE : FB_ERR_CAPACITY);
  }
  tree(FB_EFFECTS_SPIN, 0);
  for (desc.n_spring = -1; desc.n_spring <= FB_MAX_SPRINGS + 1; desc.n_spring += FB_MAX_SPRINGS + 2) {
    FBT_INT_EQ(fb_system_init(&mechanism, &work, model, &desc, 3), FB_ERR_CAPACITY);
  }
}

/* ---- forces of the caller's */

typedef struct acts { /* what the forces below are made of, and how often they were asked */
  int calls;
  fb_status status;
  int spoil;
} acts;

/* Spring 0, the springs and dampers of joint 1 and a pull cos t on spring 1. */
static fb_status spring_forces(fb_system_forces *now, void *user)
{
  acts *const of = (acts *)user;
  fb_real step[3], length, tension;
  of->calls++;
  for (int i = 0; i < 3; i++) {
    step[i] = now->point[1].position[i] - now->point[0].position[i];
  }
  length = (fb_real)sqrt((double)fb_vec3_dot(step, step));
  tension = FB_R(3.0) * (length - FB_R(1.5));
  for (int i = 0; i < 3; i++) {
    const fb_real v = now->point[1].velocity[i] - now->point[0].velocity[i];
    tension += FB_R(0.5) * v * step[i] / length;
  }
  for (int i = 0; i < 3; i++) {
    now->point[0].force[i] = tension * step[i] / length;
    now->point[1].force[i] = -now->point[0].force[i];
  }
  for (int i = 0; i < axes_of((int)joint_of(2)->kind)->count; i++) {
    fb_joint_point *const joint = &now->joint[joint_at[2]];
    joint->torque[i] = -FB_R(1.5) * joint->value[i] - FB_R(0.2) * joint->speed[i];
  }
  now->pull[1] = (fb_real)cos(3.0 * (double)now->t) + FB_R(0.1) * now->spring[1].rate;
  if (of->spoil) {
    *(of->spoil == 1   ? &now->point[0].force[0]
      : of->spoil == 2 ? &now->joint[2].torque[0]
                       : &now->pull[0]) = (fb_real)NAN;
  }
  now->joint[1].torque[2] = of->spoil == 4 ? FB_R(1.0) : FB_R(0.0);
  return of->status;
}

/* own: springs, dampers and pull are the library's, else the callback's. */
static void act(int own, int form, acts *of)
{
  tree(FB_EFFECTS_FULL, 1);
  memset(of, 0, sizeof *of);
  memset(desc.joint[2].stiffness, 0, sizeof desc.joint[2].stiffness);
  memset(desc.joint[2].damping, 0, sizeof desc.joint[2].damping);
  memset(desc.joint[2].rest, 0, sizeof desc.joint[2].rest);
  (void)spring_between(0, 1, 3, 1, own ? 3.0 : 0.0, 1.5, own ? 0.5 : 0.0);
  (void)spring_between(2, 1, 4, 0, 8.0, 0.1, own ? 0.2 : 0.3);
  for (int i = 0; i < 2; i++) {
    desc.joint[2].stiffness[i] = own ? FB_R(1.5) : FB_R(0.0);
    desc.joint[2].damping[i] = own ? FB_R(0.2) : FB_R(0.0);
  }
  desc.spring[1].damping = own ? FB_R(0.1) : FB_R(0.0);
  for (int i = 0; i < 6; i++) {
    start[0].speed[i] += i < 3 ? FB_R(2.0) : FB_R(0.0);
  }
  init(form);
  input.n_load = 2;
  input.load[1].body = 3;
  input.load[0].load.node = input.load[1].load.node = 1;
  input.forces = own ? NULL : spring_forces;
  input.user = of;
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
}

/* Steps to 0.1 s; pull and time are those of each stage. */
static void act_on(int own, int steps, int sdirk)
{
  for (int step = 0; step < steps; step++) {
    const double dt = 0.1 / steps;
    fb_system_input at[3];
    for (int i = 0; i < 3; i++) {
      at[i] = input;
      at[i].t = (fb_real)(dt * (step + 0.5 * i));
      at[i].pull[1] = own ? (fb_real)cos(3.0 * (double)at[i].t) : FB_R(0.0);
    }
    FBT_INT_EQ(sdirk ? fb_system_sdirk_step(&mechanism, model, &state, &work, &at[0], &at[2], (fb_real)dt, 6)
                     : fb_system_rk4_step(&mechanism, model, &state, &work, &at[0], &at[1], &at[2], (fb_real)dt),
               FB_OK);
  }
}

/* E9.27: forces of the caller's that are springs, dampers and motors move bodies as the library's, in every form, at
   once and over steps of either integrator; called once an evaluation. */
TEST(forces_of_the_state_act_as_springs_do)
{
  static fb_system_motion first;
  acts of;
  for (int run = 0; run < 6; run++) {
    const int form = run % 3;
    for (int own = 1; own >= 0; own--) {
      act(own, form, &of);
      input.pull[1] = own ? FB_R(1.0) : FB_R(0.0);
      motion_of(&motion, &state);
      FBT_INT_EQ(of.calls, own ? 0 : 1);
      first = own ? motion : first;
      FBT_BELOW(motion_difference(&motion, &first), FBT_TOL(1e-11, 1e-3));
      for (int i = 0; i < 3; i++) {
        FBT_NEAR_ABS(motion.force[1][i], -motion.force[0][i], 1e-30);
      }
      input.pull[1] = FB_R(0.0);
      of.calls = 0;
      act_on(own, run < 3 ? 40 : 80, run >= 3);
      FBT_TRUE(own || run >= 3 || of.calls == 160);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    }
    act(1, form, &of);
    act_on(1, run < 3 ? 40 : 80, run >= 3);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &first, &state, NULL), FB_OK);
    FBT_BELOW(fbt_difference(motion.pose[3].rho, first.pose[3].rho, 3), run < 3 ? FBT_TOL(1e-11, 1e-5) : 1e-6);
    FBT_BELOW(fbt_difference(motion.pose[2].q, first.pose[2].q, 3), run < 3 ? FBT_TOL(1e-10, 1e-4) : 1e-5);
  }
}

/* E9.27: forces that depend on time and state keep the order of the integrators. */
TEST(forces_of_the_state_keep_the_order)
{
  acts of;
  for (int sdirk = 0; sdirk < 2; sdirk++) {
    double x[3];
    for (int run = 0; run < 3; run++) {
      act(0, FB_METHOD_RECURSIVE, &of);
      act_on(0, (sdirk ? 160 : 80) << run, sdirk);
      x[run] = (double)(state.link[4].x[0] + state.link[3].quat[1]);
    }
    FBT_TRUE(FB_SINGLE || fabs(log2(fabs((x[0] - x[1]) / (x[1] - x[2]))) - (sdirk ? 2.0 : 4.0)) < 0.3);
  }
}

/* E9.27: what a callback gets wrong is refused, its own status handed on, the state as it was. */
TEST(forces_of_the_state_are_checked)
{
  acts of;
  act(0, FB_METHOD_RECURSIVE, &of);
  kept = state;
  for (int run = 0; run < 5; run++) {
    of.spoil = run;
    of.status = run == 0 ? FB_ERR_MODES : FB_OK;
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(1e-3)),
               run == 0  ? FB_ERR_MODES
               : run < 4 ? FB_ERR_NOT_FINITE
                         : FB_ERR_VALUE);
    FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, FB_R(1e-3), 0),
               run == 0  ? FB_ERR_MODES
               : run < 4 ? FB_ERR_NOT_FINITE
                         : FB_ERR_VALUE);
    FBT_TRUE(memcmp(&kept, &state, sizeof state) == 0);
  }
  of.spoil = 0;
  { /* the same forces on both sides of an implicit step */
    fb_system_input end = input;
    end.forces = NULL;
    FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &end, FB_R(1e-3), 0), FB_ERR_VALUE);
  }
}

/* A wall at y = 0 below the hub: stiff, without damping. */
static fb_status wall(fb_system_forces *now, void *user)
{
  const fb_real depth = -now->point[0].position[1];
  (void)user;
  now->point[0].force[1] = depth > FB_R(0.0) ? FB_R(4e4) * depth : FB_R(0.0);
  return FB_OK;
}

/* E9.27 in flight and contact: a ball thrown at a wall leaves it with the speed it came, after half a period of
   sqrt(m/k); far from the origin and fast along it, too. */
TEST(forces_of_the_state_see_where_bodies_fly)
{
  for (int far = 0; far < 2; far++) {
    const double dt = 1e-4, along = far ? 7500.0 : 0.0, reach = far ? 6e6 : 0.0;
    fresh();
    rigid(&model[0], 1.0, 0, 0, 0, 1.0, 1.0, 1.0);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    init(FB_METHOD_RECURSIVE);
    start[0].value[0] = (fb_real)reach;
    start[0].value[1] = FB_R(0.05);
    start[0].speed[0] = (fb_real)along;
    start[0].speed[1] = -FB_R(2.0);
    input.n_load = 1;
    input.forces = wall;
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    for (int step = 0; step < 1000; step++) {
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, (fb_real)dt), FB_OK);
    }
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
    FBT_NEAR_REL(motion.motion[0].v[1], 2.0, FBT_TOL(1e-5, 1e-3));
    FBT_NEAR_ABS(motion.pose[0].rho[1], 2.0 * (0.1 - 0.025 - pi / 200.0), FBT_TOL(1e-5, 1e-3));
    FBT_NEAR_REL(motion.motion[0].v[0], along, 1e-6);
  }
}

SUITE(system_springs, RUN(springs_between_points_balance_energy), RUN(springs_between_points_act_alike_in_every_form),
      RUN(andrews_squeezer_moves_as_published), RUN(springs_between_points_bound_the_step),
      RUN(actuators_and_lengths_are_channels_of_linear_models), RUN(springs_bound_the_step_where_they_are),
      RUN(springs_whose_points_meet_are_refused), RUN(springs_are_checked), RUN(forces_of_the_state_act_as_springs_do),
      RUN(forces_of_the_state_keep_the_order), RUN(forces_of_the_state_are_checked),
      RUN(forces_of_the_state_see_where_bodies_fly) ON_TIPS)
