/* >>trim and >>linear of bodies with lines of large deflection: steady states, spectra, buckling, flutter. */
#include "fbt.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
static fb_body body;
static fb_body_work body_work;
static fb_shape shape;
static fb_beam_desc line;
static fb_beam beam;
static fb_modes_desc keep;
static fb_modes modes;
static fb_modes_work modes_work;
static fb_body_desc level;
static fb_analyse_work work;
static fb_state state;
static fb_input input;
static fb_spectrum spectrum;
static fb_motion motion;
static fb_node_motion tip;

/* A cantilever of length, mass per length and stiffness 1, n modes along y and z. */
static void unit_line(int n_y, int n_z)
{
  memset(&line, 0, sizeof line);
  memset(&keep, 0, sizeof keep);
  memset(&level, 0, sizeof level);
  memset(&input, 0, sizeof input);
  line.length = FB_R(1.0);
  line.n_element = 8;
  line.n_station = 1;
  line.station[0].mass = FB_R(1.0);
  line.station[0].EI_y = line.station[0].EI_z = FB_R(1.0);
  keep.count[FB_KIND_BEND_Y] = n_y;
  keep.count[FB_KIND_BEND_Z] = n_z;
  level.effects = FB_EFFECTS_LARGE;
  level.base = FB_BASE_PRESCRIBED;
}

/* Adds the static deflection under a load on the tip along or about an axis to the modes. */
static void load_mode(int axis)
{
  keep.load[keep.n_load].node = line.n_element;
  keep.load[keep.n_load++].axis = axis;
}

/* The body of that line on a hub (mass 0: none), node 1 at the tip, at rest. */
static void line_body(double hub)
{
  const fb_real none[3] = {0, 0, 0}, inertia[6] = {FB_R(0.4), FB_R(0.5), FB_R(0.9), 0, 0, 0};
  int node;
  FBT_INT_EQ(fb_beam_init(&beam, &line), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  if (hub > 0.0) {
    FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)hub, none, inertia), FB_OK);
  }
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, line.length), FB_OK);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
}

static void load_tip(fb_axes axes, double x, double y, double z)
{
  input.n_load = 1;
  input.load[0].node = 1;
  input.load[0].axes = axes;
  input.load[0].force[0] = (fb_real)x;
  input.load[0].force[1] = (fb_real)y;
  input.load[0].force[2] = (fb_real)z;
}

static void settle(void)
{
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_OK);
  FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &input), FB_OK);
  FBT_INT_EQ(fb_body_node_motion_eval(&body, &tip, &state, &motion, 1), FB_OK);
}

static void spectrum_now(void)
{
  FBT_INT_EQ(fb_body_spectrum_solve(&body, &work, &spectrum, &state, &input), FB_OK);
}

static double growth(void)
{
  double most = -1e30;
  spectrum_now();
  for (int k = 0; k < spectrum.n; k++) {
    most = fmax(most, (double)spectrum.re[k]);
  }
  return most;
}

/* ---- the same line as a geometrically exact beam of 40 elements */

static fb_exact_desc exact_desc;
static fb_exact exact;
static fb_exact_state exact_state;
static fb_exact_work exact_work;
static fb_exact_input exact_input;
static fb_exact_node exact_node[FB_MAX_EXACT + 1];
static fb_exact_spectrum exact_spectrum;
static fb_exact_spectrum_work spectrum_work;

static void exact_settle(void)
{
  memset(&exact_desc, 0, sizeof exact_desc);
  exact_desc.length = line.length;
  exact_desc.n_element = FB_MAX_EXACT;
  exact_desc.n_station = 1;
  FBT_INT_EQ(fb_exact_station_init(&exact_desc.station[0], &line.station[0]), FB_OK);
  exact_desc.n_lump = line.n_lump;
  for (int k = 0; k < line.n_lump; k++) {
    exact_desc.lump[k] = line.lump[k];
    exact_desc.lump[k].node = line.lump[k].node * FB_MAX_EXACT / line.n_element;
  }
  for (int i = 0; i < 3; i++) {
    exact_desc.position[i] = line.position[i];
    exact_desc.gravity[i] = level.gravity[i];
  }
  memset(&exact_input, 0, sizeof exact_input);
  memcpy(exact_input.w, input.w, sizeof input.w);
  FBT_INT_EQ(fb_exact_init(&exact, &exact_desc), FB_OK);
  FBT_INT_EQ(fb_exact_state_init(&exact, &exact_state, &exact_work, &exact_input), FB_OK);
  FBT_INT_EQ(fb_exact_trim(&exact, &exact_state, &exact_work, &exact_input), FB_OK);
  FBT_INT_EQ(fb_exact_nodes_eval(&exact, exact_node, &exact_state), FB_OK);
}

static void same_tip(double tol)
{
  for (int i = 0; i < 3; i++) {
    FBT_NEAR_ABS(tip.position[i], exact_node[FB_MAX_EXACT].position[i], tol);
  }
}

static void same_frequencies(int count, double tol)
{
  spectrum_now();
  FBT_INT_EQ(fb_exact_spectrum_solve(&exact, &spectrum_work, &exact_spectrum, &exact_state, &exact_input, count),
             FB_OK);
  for (int k = 0; k < count; k++) {
    FBT_NEAR_REL(spectrum.im[k], exact_spectrum.im[k], tol);
    FBT_NEAR_ABS(spectrum.re[k], 0.0, FBT_TOL(1e-5, 0.2));
  }
}

/* E12.1, E12.2: a cantilever that its weight bends by 20 and 40 % of its length, and its frequencies there. */
TEST(cantilevers_bend_under_their_weight_as_exact_beams)
{
  for (int k = 0; k < 2; k++) {
    unit_line(5, 4);
    level.effects |= FB_EFFECT_GRAVITY;
    level.gravity[1] = k ? -FB_R(4.2) : -FB_R(1.75);
    line_body(0.0);
    settle();
    exact_settle();
    FBT_TRUE(fabs((double)tip.position[1]) > (k ? 0.38 : 0.19));
    same_tip(FBT_TOL(2e-4, 2e-3));
    same_frequencies(4, FBT_TOL(1e-3, 1e-2));
  }
}

/* E14.41: internal loads, by parabolas between the nodes of the exact beam, to `tol` of the largest force or moment. */
static void same_internal_loads(double tol)
{
  static fb_line_motion point[FB_MAX_LINE_POINTS];
  int n;
  double force = 0.0, moment = 0.0;
  FBT_INT_EQ(fb_body_lines_eval(&body, point, &n, &state, &motion, &input), FB_OK);
  for (int i = 0; i < 3; i++) {
    force = fmax(force, fabs((double)exact_node[0].force[i]));
    moment = fmax(moment, fabs((double)exact_node[0].moment[i]));
  }
  for (int p = 0; p < n; p++) {
    const double at = FB_MAX_EXACT * (double)point[p].at.x / (double)line.length;
    const int low = at < FB_MAX_EXACT - 1 ? (int)at : FB_MAX_EXACT - 1;
    const int ends = low == 0 || (line.n_lump > 0 && 2 * (low - 1) == FB_MAX_EXACT);
    const fb_exact_node *const a = &exact_node[ends ? low : low - 1];
    const double u = at - (ends ? low : low - 1),
                 w[3] = {0.5 * (u - 1.0) * (u - 2.0), u * (2.0 - u), 0.5 * u * (u - 1.0)};
    if (line.n_lump > 0 && 2 * low == FB_MAX_EXACT && at > low + 1e-6) {
      continue; /* the node before is on the inboard side of the lumped body */
    }
    for (int i = 0; i < 3; i++) {
      double F = 0.0, M = 0.0;
      for (int k = 0; k < 3; k++) {
        F += w[k] * (double)a[k].force[i];
        M += w[k] * (double)a[k].moment[i];
      }
      FBT_NEAR_ABS(point[p].force[i], F, tol * force);
      FBT_NEAR_ABS(point[p].moment[i], M, tol * moment);
    }
  }
}

/* E12.1, E12.3, E14.13: a blade that turns and droops: its steady state, internal loads and frequencies; with torsion,
   a mass center off its line and a lumped body at its middle. */
TEST(spinning_blades_have_the_frequencies_of_exact_beams)
{
  for (int k = 0; k < 3; k++) {
    unit_line(5, 5);
    line.position[0] = FB_R(0.1);
    level.effects |= FB_EFFECT_GRAVITY;
    level.gravity[2] = -FB_R(3.0);
    input.w[2] = k == 1 ? FB_R(10.0) : FB_R(3.0);
    keep.spin = k == 1 ? FB_R(10.0) : FB_R(0.0);
    keep.spin_radius = k == 1 ? FB_R(0.1) : FB_R(0.0);
    line.station[0].EI_z = FB_R(2.0);
    if (k == 1) {
      keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 6;
    }
    if (k == 2) {
      line.station[0].GJ = FB_R(0.8);
      line.station[0].i_y = FB_R(1e-3);
      line.station[0].i_z = FB_R(3e-3);
      line.station[0].mass_y = FB_R(0.02);
      /* coupled modes: those of torsion bend, too */
      keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = keep.count[FB_KIND_TORSION] = 6;
      line.n_lump = 1;
      line.lump[0].node = line.n_element / 2;
      line.lump[0].mass = FB_R(0.2);
      line.lump[0].center[1] = FB_R(0.03);
      line.lump[0].center[2] = FB_R(0.02);
      line.lump[0].inertia[0] = line.lump[0].inertia[1] = line.lump[0].inertia[2] = FB_R(1e-3);
    }
    line_body(0.0);
    settle();
    exact_settle();
    same_internal_loads(FBT_TOL(1e-3, 1e-2));
    same_tip(FBT_TOL(1e-3, 3e-3));
    same_frequencies(4, FBT_TOL(1e-3, 1e-2));
  }
}

/* E12.3, E14.8: Beck's column: a follower force that presses on the tip; frequencies at P = 15 and flutter at 20.05
   EI/L^2, with a tip mass of half the beam's at 16.06 (tests/reference/p06_beck.csv). */
TEST(columns_under_follower_forces_flutter_as_beck_says)
{
  const double critical[2] = {20.0509536189738, 16.0615619664041};
  for (int k = 0; k < 2; k++) {
    unit_line(8, 0);
    keep.line_points = 18;
    if (k) {
      line.n_lump = 1;
      line.lump[0].node = line.n_element;
      line.lump[0].mass = FB_R(0.5);
    }
    line_body(0.0);
    load_tip(FB_AXES_NODE, k ? -10.0 : -15.0, 0.0, 0.0);
    spectrum_now();
    FBT_NEAR_REL(spectrum.im[0], k ? 3.458950142937 : 6.627406683472, FBT_TOL(1e-3, 1e-2));
    FBT_NEAR_REL(spectrum.im[1], k ? 12.77913619375 : 16.25982976253, FBT_TOL(1e-3, 1e-2));
    load_tip(FB_AXES_NODE, -critical[k] * (1.0 - FBT_TOL(1e-3, 2e-2)), 0.0, 0.0);
    FBT_BELOW(growth(), FBT_TOL(1e-4, 0.1));
    load_tip(FB_AXES_NODE, -critical[k] * (1.0 + FBT_TOL(1e-3, 2e-2)), 0.0, 0.0);
    FBT_TRUE(growth() > 0.1);
  }
}

/* E12.1, E12.3, E14.8: Euler's column: a dead force that presses on the tip, pi^2/4 EI/L^2; behind it, the elastica at
   a tip rotation of 40 and 100 degrees (tests/reference/p06_postbuckling.csv). */
TEST(columns_buckle_as_euler_says)
{
  const double load[2] = {2.6244839138332, 3.7464741792108};
  const double x[2] = {0.88120351172601, 0.34898930041483}, y[2] = {0.42224034012119, 0.79153949653692};
  unit_line(6, 0);
  load_mode(1);
  line_body(0.0);
  load_tip(FB_AXES_INERTIAL, -pi * pi / 4.0 * (1.0 - FBT_TOL(1e-3, 2e-2)), 0.0, 0.0);
  FBT_BELOW(growth(), FBT_TOL(1e-4, 0.1));
  load_tip(FB_AXES_INERTIAL, -pi * pi / 4.0 * (1.0 + FBT_TOL(1e-3, 2e-2)), 0.0, 0.0);
  FBT_TRUE(growth() > 0.05);
  for (int k = 0; k < 2; k++) {
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    for (int i = 1; i <= 4; i++) { /* pushed aside step by step, then let go */
      load_tip(FB_AXES_INERTIAL, -load[k] * 0.25 * i, 0.5, 0.0);
      settle();
    }
    load_tip(FB_AXES_INERTIAL, -load[k], 0.0, 0.0);
    settle();
    FBT_NEAR_ABS(tip.position[0], x[k], FBT_TOL(1e-3, 1e-2));
    FBT_NEAR_ABS(tip.position[1], y[k], FBT_TOL(1e-3, 1e-2));
    FBT_BELOW(growth(), FBT_TOL(1e-4, 0.1));
  }
}

/* E12.1, E12.3, E14.8: a deep cantilever, stiff in the plane of its load, tips over at 4.0126 sqrt(EI GJ)/L^2: Prandtl,
   Michell; Timoshenko and Gere 6.3. */
TEST(deep_cantilevers_tip_over_at_prandtls_load)
{
  const double EI = 1.0, GJ = 0.7, critical = 4.0126 * sqrt(EI * GJ);
  unit_line(0, 7);
  line.station[0].EI_z = FB_R(0.0); /* rigid */
  line.station[0].GJ = (fb_real)GJ;
  line.station[0].i_y = line.station[0].i_z = FB_R(0.005);
  keep.count[FB_KIND_TORSION] = 7;
  load_mode(2);
  line_body(0.0);
  for (int k = 0; k < 2; k++) {
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    load_tip(FB_AXES_INERTIAL, 0.0, -critical * (1.0 + (k ? 1.0 : -1.0) * FBT_TOL(1e-3, 2e-2)), 0.0);
    settle();
    FBT_TRUE(k ? growth() > 0.05 : growth() < FBT_TOL(1e-4, 0.1));
  }
}

/* E12.1, E14.13: a free body that spins about its hub and bends by that stays as trim found it. */
TEST(trimmed_spins_are_steady)
{
  const fb_base base[3] = {FB_BASE_FREE, FB_BASE_PINNED, FB_BASE_HINGED};
  for (int k = 0; k < 3; k++) {
    static fb_rk4_work step_work;
    fb_state start;
    double moved = 0.0, bent = 0.0;
    unit_line(3, 3);
    line.position[1] = FB_R(0.3);
    line.position[2] = k == 2 ? FB_R(0.0) : FB_R(0.2);
    level.base = base[k];
    line_body(3.0);
    input.w[2] = FB_R(4.0);
    settle();
    start = state;
    for (int i = 0; i < 1000; i++) {
      FBT_INT_EQ(fb_rk4_step(&body, &state, &step_work, &input, &input, &input, FB_R(1e-3)), FB_OK);
    }
    for (int a = 0; a < body.n; a++) {
      moved = fmax(moved, fabs((double)(state.q[a] - start.q[a])));
      bent = fmax(bent, fabs((double)start.q[a]));
    }
    FBT_TRUE(bent > 0.02);
    FBT_BELOW(moved, FBT_TOL(1e-8, 1e-2) * bent);
  }
}

/* Drag of 2 a by mass, as a distributed load: about rest every mode has re = -a, im = sqrt(omega^2 - a^2). */
static fb_status drag(fb_line_point *p, int n, fb_real t, void *user)
{
  const double *const rate = (const double *)user;
  for (int k = 0; k < n; k++) {
    for (int i = 0; i < 3; i++) {
      p[k].force[i] = (fb_real)(-rate[0] * (double)p[k].length) * p[k].velocity[i];
    }
  }
  (void)t;
  return FB_OK;
}

/* E14.40, E12.3: a drag of c v a mass damps every mode by c/2 and lowers its frequency to sqrt(omega^2 - c^2/4). */
TEST(distributed_drag_damps_modes_in_closed_form)
{
  double rate = 0.6;
  unit_line(3, 2);
  line_body(0.0);
  input.distributed = drag;
  input.user = &rate;
  spectrum_now();
  FBT_INT_EQ(spectrum.n, 5);
  for (int k = 0; k < 5; k++) {
    const double omega = (double)modes.omega[k];
    FBT_NEAR_ABS(spectrum.re[k], -0.3, FBT_TOL(1e-5, 2e-2));
    FBT_NEAR_REL(spectrum.im[k], sqrt(omega * omega - 0.09), FBT_TOL(1e-5, 1e-2));
  }
}

/* A bearing at the tip as a distributed load: a spring across the axis of the spin, the same in every attitude. */
static fb_status bearing(fb_line_point *p, int n, fb_real t, void *user)
{
  const double *const stiffness = (const double *)user;
  for (int k = 0; k < n; k++) {
    for (int i = 1; i < 3 && p[k].x > FB_R(0.999); i++) {
      p[k].force[i] = (fb_real)(-stiffness[0]) * p[k].position[i];
    }
  }
  (void)t;
  return FB_OK;
}

/* E12.4, E14.6: gyroscopic whirl of a round shaft with rotary inertia, on a pin at its root and a stiff bearing at its
   tip, in the axes of its spin: each frequency less the spin (tests/reference/p06_shaft_whirl.csv). */
TEST(shafts_of_lines_whirl_as_in_closed_form)
{
  const fbt_table *t = fbt_reference("p06_shaft_whirl.csv");
  double stiffness = FBT_TOL(1e6, 1e5), most = 0.0;
  for (int row = 0; row < t->rows; row += FBT_LONG(1, 3)) {
    const double r = fbt_value(t, row, "r_over_L"), spin = fbt_value(t, row, "Om");
    const double way[2] = {fabs(fbt_value(t, row, "forward") - spin), fbt_value(t, row, "backward") + spin};
    unit_line(6, 6);
    line.root = FB_ROOT_PINNED;
    line.station[0].i_y = line.station[0].i_z = (fb_real)(r * r);
    keep.rigid = 1;
    load_mode(1);
    load_mode(2);
    line_body(0.0);
    input.w[0] = (fb_real)spin;
    input.distributed = bearing;
    input.user = &stiffness;
    settle();
    spectrum_now();
    for (int i = 0; i < 2; i++) {
      double best = 1e9;
      for (int k = 0; k < spectrum.n; k++) {
        best = fmin(best, fabs(fabs((double)spectrum.im[k]) - way[i]));
      }
      most = fmax(most, best / fbt_value(t, row, "forward"));
    }
  }
  FBT_BELOW(most, FBT_TOL(2e-4, 1e-2));
  fbt_figure("whirl of a shaft as a line, 8 modes a plane, relative", "closed form", most);
}

/* E12.2: about a state bent by 40 %, C A^-1 B of the linear model is the change of the trimmed tip by a small force. */
TEST(linear_models_of_bent_lines_answer_as_trims_do)
{
  static fb_linear linear;
  static fb_real A[FB_MAX_LINEAR * FB_MAX_LINEAR], scale[FB_MAX_LINEAR], b[FB_MAX_LINEAR], x[FB_MAX_LINEAR];
  int perm[FB_MAX_LINEAR];
  fb_linear_desc ports;
  double moved[2][3];
  const double h = FBT_TOL(1e-4, 1e-2);
  memset(&ports, 0, sizeof ports);
  unit_line(4, 4);
  level.effects |= FB_EFFECT_GRAVITY;
  level.gravity[1] = -FB_R(4.0);
  level.gravity[2] = FB_R(1.0);
  line_body(0.0);
  settle();
  ports.n_in = 1;
  ports.in[0].kind = FB_PORT_FORCE;
  ports.in[0].node = 1;
  ports.in[0].axis = 1;
  ports.n_out = 3;
  for (int i = 0; i < 3; i++) {
    ports.out[i].kind = FB_PORT_DISPLACEMENT;
    ports.out[i].node = 1;
    ports.out[i].axis = i;
  }
  FBT_INT_EQ(fb_body_linearize(&body, &work, &linear, &state, &input, &ports), FB_OK);
  memcpy(A, linear.A, sizeof(fb_real) * (size_t)(linear.n * linear.n));
  for (int i = 0; i < linear.n; i++) {
    b[i] = -linear.B[i];
  }
  FBT_INT_EQ(fb_lu_factor(A, perm, scale, linear.n), FB_OK);
  fb_lu_solve(x, A, perm, b, linear.n);
  for (int side = 0; side < 2; side++) {
    load_tip(FB_AXES_BODY, 0.0, side ? h : -h, 0.0);
    settle();
    for (int i = 0; i < 3; i++) {
      moved[side][i] = (double)tip.position[i];
    }
  }
  for (int i = 0; i < 3; i++) {
    double y = (double)linear.D[i];
    for (int j = 0; j < linear.n; j++) {
      y += (double)linear.C[i * linear.n + j] * (double)x[j];
    }
    FBT_NEAR_ABS(y, (moved[1][i] - moved[0][i]) / (2.0 * h), FBT_TOL(1e-7, 3e-2));
  }
}

/* E12.2: bent in one plane a tip turns by sum theta_a q_a, also at half a turn, where rotation vectors jump. */
TEST(rotations_of_half_a_turn_have_linear_models)
{
  static fb_linear linear;
  fb_linear_desc ports;
  memset(&ports, 0, sizeof ports);
  ports.n_out = 1;
  ports.out[0].kind = FB_PORT_ROTATION;
  ports.out[0].node = 1;
  ports.out[0].axis = 2;
  for (int side = -1; side <= 1; side++) {
    fb_state bent;
    unit_line(2, 0);
    line_body(0.0);
    FBT_INT_EQ(fb_state_init(&body, &bent), FB_OK);
    memset(&input, 0, sizeof input);
    bent.q[0] = (fb_real)(3.14159265358979 * (1.0 + side * FBT_TOL(1e-7, 1e-4)) / (double)body.node[1].theta[2]);
    FBT_INT_EQ(fb_body_linearize(&body, &work, &linear, &bent, &input, &ports), FB_OK);
    for (int a = 0; a < body.n; a++) {
      FBT_NEAR_REL(linear.C[a], (double)body.node[1].theta[3 * a + 2], FBT_TOL(1e-9, 1e-2));
    }
  }
}

/* E12.1: a dead tip force P of 10 and 40 EI/L^2 finds its steady state from the straight line at once. The elastica's
   first integral ties tip angle and place: (P x)^2/(2 EI) = P sin phi. */
TEST(trims_reach_far_from_the_straight_line)
{
  for (int k = 0; k < 2; k++) {
    const double P = k ? 40.0 : 10.0;
    fb_real R[9];
    unit_line(0, 6);
    load_mode(2);
    line_body(0.0);
    load_tip(FB_AXES_INERTIAL, 0.0, 0.0, P);
    FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_OK);
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &input), FB_OK);
    FBT_INT_EQ(fb_body_node_motion_eval(&body, &tip, &state, &motion, 1), FB_OK);
    fb_quat_to_mat33(R, tip.quat);
    FBT_NEAR_REL(0.5 * P * pow((double)tip.position[0], 2.0), (double)R[6], 2e-3);
    FBT_TRUE((double)tip.position[2] > (k ? 0.90 : 0.81));
  }
}

SUITE(analyse_lines, RUN(cantilevers_bend_under_their_weight_as_exact_beams),
      RUN(spinning_blades_have_the_frequencies_of_exact_beams), RUN(columns_under_follower_forces_flutter_as_beck_says),
      RUN(columns_buckle_as_euler_says), RUN(deep_cantilevers_tip_over_at_prandtls_load), RUN(trimmed_spins_are_steady),
      RUN(distributed_drag_damps_modes_in_closed_form), RUN(shafts_of_lines_whirl_as_in_closed_form),
      RUN(linear_models_of_bent_lines_answer_as_trims_do), RUN(rotations_of_half_a_turn_have_linear_models),
      RUN(trims_reach_far_from_the_straight_line))
