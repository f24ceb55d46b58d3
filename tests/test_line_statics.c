/* Equilibria of beams that bend far: the elastica under moments, dead and follower loads, and the 45 degree bend. */
#include "line.h"

static fb_analyse_work analyse_work;
static fb_input input;
static fb_state state;

static const double pi = 3.14159265358979323846;

/* A clamped beam of unit length and stiffness with natural modes and load modes at the tip. */
static void elastica(int n, int points, int force, int moment)
{
  line_beam(1.0, 1.0, 1.0, 1.0, 10);
  body_desc.base = FB_BASE_PRESCRIBED;
  line_count(n - force - moment, 0, 0, 0);
  if (force) {
    line_load_mode(10, 1);
  }
  if (moment) {
    line_load_mode(10, 5);
  }
  keep.line_points = points;
  memset(&input, 0, sizeof input);
  input.n_load = 1;
  input.load[0].node = 3;
  line_build();
  FBT_INT_EQ(FB_SINGLE ? n : modes.n, n); /* single precision may not tell a load mode from the natural ones */
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
}

/* Equilibrium under the load that grows from nothing to all of it in `parts`. */
static void settle(int parts)
{
  const fb_load whole = input.load[0];
  fb_status status = FB_OK;
  for (int k = 1; k <= parts && status == FB_OK; k++) {
    for (int i = 0; i < 3; i++) {
      input.load[0].force[i] = whole.force[i] * (fb_real)k / (fb_real)parts;
      input.load[0].torque[i] = whole.torque[i] * (fb_real)k / (fb_real)parts;
    }
    status = fb_body_trim(&body, &state, &analyse_work, &input);
  }
  FBT_INT_EQ(status, FB_OK);
  input.load[0] = whole;
}

/* Pure bending is a circle: constant curvature, which is the load mode of a tip moment. E14.1 to E14.4, E14.8. */
TEST(a_moment_bends_a_line_into_circles)
{
  for (int turns = 1; turns <= 3; turns += 2) {
    fb_node_motion tip;
    fb_energy energy;
    elastica(3, turns == 1 ? 0 : 30, 0, 1);
    input.load[0].axes = FB_AXES_BODY;
    input.load[0].torque[2] = (fb_real)(2.0 * pi * turns);
    settle(8 * turns);
    line_node(&tip, &body, &state, 3);
    FBT_NEAR_ABS(tip.position[0], 0.0, FBT_TOL(1e-9, 1e-3));
    FBT_NEAR_ABS(tip.position[1], 0.0, FBT_TOL(1e-9, 1e-3));
    FBT_NEAR_ABS(fabs((double)tip.quat[0]), 1.0, FBT_TOL(1e-9, 1e-3));
    FBT_INT_EQ(fb_body_energy_eval(&body, &energy, &state, &input), FB_OK);
    FBT_NEAR_REL(energy.strain, 2.0 * pi * pi * turns * turns, FBT_TOL(1e-9, 1e-3));
    fbt_figure(turns == 1 ? "tip moment, full circle: closure by the length" : "three turns: closure by the length",
               "circle", hypot((double)tip.position[0], (double)tip.position[1]));
    if (turns == 3) { /* with points too far apart for it the shape is refused, E14.2 */
      const fb_state wound = state;
      elastica(3, 0, 0, 1);
      FBT_INT_EQ(fb_body_energy_eval(&body, &energy, &wound, &input), FB_ERR_RANGE);
    }
  }
}

/* The elastica from its tip, turned by `slope` under the dead load alpha EI/L^2 across the root's axis, back over its
   length 1: theta'' = -alpha cos theta. tip: its place from the other end. Returns theta there. */
static double shoot(double tip[2], double alpha, double slope)
{
  const int n = 4000;
  const double h = 1.0 / n;
  double theta = slope, rate = 0.0; /* by the length from the tip */
  tip[0] = tip[1] = 0.0;
  for (int k = 0; k < n; k++) { /* Stoermer and Verlet; the sums are the midpoint rule */
    rate -= 0.5 * h * alpha * cos(theta);
    tip[0] += h * cos(theta + 0.5 * h * rate);
    tip[1] += h * sin(theta + 0.5 * h * rate);
    theta += h * rate;
    rate -= 0.5 * h * alpha * cos(theta);
  }
  return theta;
}

/* E14.8: dead loads beyond the table of the next test, to 20 EI/L^2. */
TEST(elastica_under_heavy_dead_loads)
{
  double most = 0.0;
  if (FB_SINGLE) { /* they want the load mode */
    return;
  }
  for (double alpha = 10.0; alpha <= 20.0; alpha += 5.0) {
    fb_node_motion end;
    double tip[2], low = 0.1, high = 0.5 * pi;
    for (int k = 0; k < 50; k++) {
      const double middle = 0.5 * (low + high);
      if (shoot(tip, alpha, middle) < 0.0) {
        low = middle;
      } else {
        high = middle;
      }
    }
    elastica(6, 0, 1, 0);
    input.load[0].axes = FB_AXES_INERTIAL;
    input.load[0].force[1] = (fb_real)alpha;
    settle(20);
    line_node(&end, &body, &state, 3);
    most = fmax(most, hypot((double)end.position[0] - tip[0], (double)end.position[1] - tip[1]));
  }
  FBT_BELOW(most, 1e-3);
  fbt_figure("dead tip load of 10 to 20 EI/L^2, six modes, by the length", "shooting", most);
}

/* E14.8: dead and follower loads across the tip up to 20 EI/L^2, six modes, one of them the load's. */
TEST(elastica_under_tip_loads)
{
  static const char *name[2] = {"p04_dead_load.csv", "p04_follower.csv"};
  for (int k = 0; k < 2; k++) {
    const fbt_table *table = fbt_reference(name[k]);
    double most = 0.0;
    for (int row = 0; row < table->rows; row++) {
      fb_node_motion tip;
      if (FB_SINGLE && fbt_value(table, row, "alpha") > 10.0) {
        continue; /* wants the load mode */
      }
      elastica(6, 0, 1, 0);
      input.load[0].axes = k ? FB_AXES_NODE : FB_AXES_INERTIAL;
      input.load[0].force[1] = (fb_real)fbt_value(table, row, "alpha");
      settle(20);
      line_node(&tip, &body, &state, 3);
      most = fmax(most, hypot((double)tip.position[0] - fbt_value(table, row, "x_tip"),
                              (double)tip.position[1] - fbt_value(table, row, "y_tip")));
      FBT_NEAR_ABS(2.0 * atan2((double)tip.quat[3], (double)tip.quat[0]), fbt_value(table, row, "theta_tip"),
                   FBT_TOL(2e-3, 2e-2));
    }
    FBT_BELOW(most, FBT_TOL(2e-4, 3e-2)); /* in single precision without the load mode */
    fbt_figure(k ? "follower tip load to 20 EI/L^2, six modes, by the length"
                 : "dead tip load to 10 EI/L^2, six modes, by the length",
               "elastica", most);
  }
}

/* E14.1, E14.8: an arc of 45 degrees, clamped, loaded across its plane: bending in both planes with torsion. */
TEST(the_45_degree_bend_as_a_body)
{
  static const struct {
    const char *name;
    double GJ, GA;
  } variant[2] = {{"literature", 1e7 / 12.0, 5e6}, {"saint_venant", 5e6 * 0.14057701, 5e6}};
  const fbt_table *table;
  double most = 0.0;
  if (FB_SINGLE) { /* its modes want double precision */
    return;
  }
  table = fbt_reference("p05_bend45.csv");
  for (int row = 0; row < FBT_LONG(table->rows, 1); row++) {
    for (int k = 0; k < 2; k++) {
      fb_node_motion tip;
      double e, size;
      if (strcmp(fbt_word(table, row, "variant"), variant[k].name) != 0) {
        continue;
      }
      line_beam(100.0 * 0.25 * pi, 1.0, 1e7 / 12.0, 1e7 / 12.0, 20);
      line_solid(1.0 / 12.0, 1.0 / 12.0, variant[k].GJ);
      beam_desc.station[0].EA = FB_R(1e7);
      beam_desc.station[0].GA_y = beam_desc.station[0].GA_z = (fb_real)variant[k].GA;
      line_chain(20, 0.25 * pi, 0);
      for (int i = 0; i <= 20; i++) { /* nodes on the arc; y of the beam is -x of the reference, x its y */
        beam_desc.point[i][0] = (fb_real)(100.0 * sin(0.25 * pi * i / 20.0));
        beam_desc.point[i][1] = (fb_real)(-100.0 * (1.0 - cos(0.25 * pi * i / 20.0)));
      }
      beam_desc.length = (fb_real)(20.0 * 200.0 * sin(0.25 * pi / 40.0));
      keep.lowest = 10;
      line_load_mode(20, 2);
      line_load_mode(20, 1);
      body_desc.base = FB_BASE_PRESCRIBED;
      line_build();
      memset(&input, 0, sizeof input);
      input.n_load = 1;
      input.load[0].node = 3;
      input.load[0].force[2] = (fb_real)fbt_value(table, row, "P");
      FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
      settle(10);
      line_node(&tip, &body, &state, 3);
      e = hypot(hypot(-(double)tip.position[1] - fbt_value(table, row, "x"),
                      (double)tip.position[0] - fbt_value(table, row, "y")),
                (double)tip.position[2] - fbt_value(table, row, "z"));
      size = hypot(hypot(fbt_value(table, row, "ux"), fbt_value(table, row, "uy")), fbt_value(table, row, "uz"));
      most = fmax(most, e / size);
    }
  }
  FBT_BELOW(most, 1e-3);
  fbt_figure("45 degree bend, by the displacement of the tip", "p05_bend45", most);
}

SUITE(line_statics, RUN(a_moment_bends_a_line_into_circles), RUN_LONG(elastica_under_tip_loads),
      RUN(elastica_under_heavy_dead_loads), RUN_LONG(the_45_degree_bend_as_a_body))
