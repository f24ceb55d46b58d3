/* >>exact: the exact beam at rest: loads, large deflection, sections, ends, units. */
#include "exact.h"

/* ---- statics */

/* E10.7: dead and follower tip forces against elliptic functions, by elements. */
static double elastica_error(const fbt_table *t, int row, fb_axes axes, int n)
{
  elastica(n);
  load_tip(axes, 0.0, fbt_value(t, row, "alpha"), 0.0);
  settle();
  return distance(node[n].position, fbt_value(t, row, "x_tip"), fbt_value(t, row, "y_tip"), 0.0);
}

/* E10.7, E10.8: dead and follower tip loads to 20 EI/L^2 against elliptic functions: twice the elements, a sixteenth of
   the error. */
TEST(elastica_is_of_order_four)
{
  double worst = 0.0;
  for (int follower = 0; follower < 2; follower++) {
    const fbt_table *t = fbt_reference(follower ? "p04_follower.csv" : "p04_dead_load.csv");
    const fb_axes axes = follower ? FB_AXES_NODE : FB_AXES_INERTIAL;
    for (int row = 0; row < t->rows; row++) {
      const double fine = elastica_error(t, row, axes, 40);
      FBT_BELOW(fine, FBT_TOL(2e-6, 2e-5));
      FBT_NEAR_ABS(node[40].rotation[2], fbt_value(t, row, "theta_tip"), FBT_TOL(5e-6, 2e-4));
      worst = fine > worst ? fine : worst;
      if (!FB_SINGLE) {
        FBT_NEAR_ABS(log2(elastica_error(t, row, axes, 20) / fine), 4.0, 0.1);
      }
    }
  }
  fbt_figure("elastica, dead and follower tip loads to 20 EI/L^2, 40 elements, of the length", "elliptic functions",
             worst);
}

/* E10.5, E10.6: what bends by a constant or linear moment is exact at the nodes with any number of elements; the linear
   limit of a cantilever under tip force, tip moment and with shear. */
TEST(linear_cantilevers_are_exact_at_the_nodes)
{
  for (int n = 1; n <= 3; n++) {
    const double stiffness[6] = {1e3, 50.0, 60.0, 2.0, 5.0, 7.0}, f = FBT_TOL(1e-8, 1e-3);
    beam(2.0, n, stiffness, NULL);
    load_tip(FB_AXES_INERTIAL, 3.0 * f, f, -f);
    input.load[0].torque[0] = (fb_real)(2.0 * f);
    input.load[0].torque[1] = (fb_real)f;
    settle();
    FBT_NEAR_REL(node[n].displacement[1], f * (8.0 / 21.0 + 2.0 / 50.0), FBT_TOL(1e-6, 2e-3));
    FBT_NEAR_REL(node[n].displacement[2], -f * (8.0 / 15.0 + 2.0 / 60.0 + 4.0 / 10.0), FBT_TOL(1e-6, 2e-3));
    FBT_NEAR_REL(node[n].rotation[0], 2.0 * f, FBT_TOL(1e-6, 2e-3));
    FBT_NEAR_REL(node[n].rotation[1], f * (4.0 / 10.0 + 2.0 / 5.0), FBT_TOL(1e-6, 2e-3));
    for (int k = 1; k <= n; k++) { /* the internal loads at the nodes */
      FBT_NEAR_REL(node[k].force[1], f, FBT_TOL(1e-6, 2e-2));
      FBT_NEAR_ABS(node[k].moment[2], f * (2.0 - 2.0 * k / n), FBT_TOL(1e-6, 2e-2) * f);
    }
  }
}

/* E10.5: a taper is a mean of compliance: stretch and twist of L = 2, A(x) linear between stations 2 and 1. */
TEST(tapered_rods_are_exact_at_the_nodes)
{
  const double stiffness[6] = {2e6, 1e6, 1e6, 2e4, 1e4, 1e4};
  beam(2.0, 3, stiffness, NULL);
  desc.n_station = 2;
  desc.station[1] = desc.station[0];
  desc.station[1].x = FB_R(2.0);
  for (int i = 0; i < 36; i++) {
    desc.station[1].stiffness[i] *= FB_R(0.5);
  }
  load_tip(FB_AXES_NODE, FBT_TOL(100.0, 1e5), 0.0, 0.0);
  input.load[0].torque[0] = FB_R(10.0);
  settle();
  FBT_NEAR_REL(node[3].displacement[0], FBT_TOL(100.0, 1e5) * 2.0 / 1e6 * log(2.0), FBT_TOL(1e-9, 1e-4));
  FBT_NEAR_REL(node[3].rotation[0], 10.0 * 2.0 / 1e4 * log(2.0), FBT_TOL(1e-9, 1e-4));
  desc.place[1] = FB_R(0.1); /* any elements */
  desc.place[2] = FB_R(1.7);
  desc.place[3] = FB_R(2.0);
  settle();
  FBT_NEAR_REL(node[3].displacement[0], FBT_TOL(100.0, 1e5) * 2.0 / 1e6 * log(2.0), FBT_TOL(1e-9, 1e-4));
  desc.n_station = 3; /* uniform up to the middle, then down to half */
  desc.station[2] = desc.station[1];
  desc.station[1] = desc.station[0];
  desc.station[1].x = desc.place[1] = FB_R(1.0);
  settle();
  FBT_NEAR_REL(node[3].displacement[0], FBT_TOL(100.0, 1e5) / 1e6 * (0.5 + log(2.0)), FBT_TOL(1e-9, 1e-4));
  FBT_NEAR_REL(node[3].rotation[0], 10.0 / 1e4 * (0.5 + log(2.0)), FBT_TOL(1e-9, 1e-4));
}

/* E10.15: loads and couples f along a line of which the compliance 1/(c (4 - x)) rises to its double: stretch and turns
   of L = 2 by f/c (2 - 2 log 2). */
TEST(loads_on_tapered_lines_are_exact_at_the_nodes)
{
  const double stiffness[6] = {2e6, 0.0, 0.0, 2e4, 4e4, 6e4}, part = 2.0 - 2.0 * log(2.0);
  const double pull = FBT_TOL(100.0, 1e5), couple = FBT_TOL(1e-3, 1e-1);
  for (int run = 0; run < 6; run++) {
    const int n = 1 + run / 2, pulled = run % 2;
    beam(2.0, n, stiffness, NULL);
    desc.n_station = 2;
    desc.station[1] = desc.station[0];
    desc.station[1].x = FB_R(2.0);
    for (int i = 0; i < 36; i++) {
      desc.station[1].stiffness[i] *= FB_R(0.5);
    }
    for (int k = 0; k < n; k++) {
      input.line[k].axes = FB_AXES_NODE;
      input.line[k].force[0] = (fb_real)(pulled ? pull : 0.0);
      for (int i = 0; i < 3; i++) {
        input.line[k].torque[i] = (fb_real)(pulled ? 0.0 : couple);
      }
    }
    settle();
    if (pulled) {
      FBT_NEAR_REL(node[n].displacement[0], pull / 5e5 * part, FBT_TOL(1e-9, 1e-4));
    }
    for (int i = 0; i < 3 && !pulled; i++) {
      FBT_NEAR_REL(node[n].rotation[i], couple / (5e3 * (i + 1)) * part, FBT_TOL(1e-6, 1e-3));
    }
  }
}

/* E10.5: a rod that stretches, rigid otherwise, carries any load across without a deflection; a rigid bar every one. */
TEST(rigid_beams_do_not_deflect)
{
  for (int rigid = 0; rigid < 2; rigid++) {
    const double stiffness[6] = {rigid ? 0.0 : 500.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    beam(2.0, 3, stiffness, NULL);
    load_tip(FB_AXES_INERTIAL, 10.0, 20.0, -30.0);
    input.load[0].torque[0] = FB_R(5.0);
    settle();
    FBT_NEAR_REL(node[3].displacement[0], rigid ? 0.0 : 10.0 * 2.0 / 500.0, FBT_TOL(1e-12, 1e-5));
    FBT_BELOW(fabs((double)node[3].displacement[0]), 0.05);
    FBT_BELOW(fbt_largest(node[3].displacement + 1, 2), FBT_TOL(1e-12, 1e-5));
    FBT_BELOW(fbt_largest(node[3].rotation, 3), FBT_TOL(1e-12, 1e-5));
    FBT_NEAR_REL(node[0].reaction_force[1], -20.0, FBT_TOL(1e-12, 1e-5));
    FBT_NEAR_REL(node[0].reaction_moment[2], -40.0 * (rigid ? 1.0 : 1.02), FBT_TOL(1e-12, 1e-5));
  }
}

/* E10.6: loads and couples along the line: the ends of a linear beam are exact with one element. */
TEST(line_loads_are_exact_at_the_nodes)
{
  for (int n = 1; n <= 3; n++) {
    const double stiffness[6] = {1e3, 50.0, 50.0, 2.0, 5.0, 7.0}, f = FBT_TOL(1e-8, 1e-3);
    beam(2.0, n, stiffness, NULL);
    for (int k = 0; k < n; k++) {
      input.line[k].axes = FB_AXES_NODE;
      input.line[k].force[1] = (fb_real)f;
      input.line[k].torque[0] = (fb_real)(2.0 * f);
      input.line[k].torque[1] = (fb_real)(3.0 * f);
    }
    settle();
    FBT_NEAR_REL(node[n].displacement[1], f * (16.0 / 56.0 + 4.0 / 100.0), FBT_TOL(1e-6, 1e-2)); /* L^4/8EI, L^2/2GA */
    FBT_NEAR_REL(node[n].displacement[2], -3.0 * f * 8.0 / 15.0, FBT_TOL(1e-6, 5e-3));           /* m L^3/3EI */
    FBT_NEAR_REL(node[n].rotation[0], 2.0 * f * 4.0 / 4.0, FBT_TOL(1e-6, 5e-3));
    FBT_NEAR_REL(node[n].rotation[1], 3.0 * f * 4.0 / 10.0, FBT_TOL(1e-6, 5e-3));
    FBT_NEAR_REL(node[n].rotation[2], f * 8.0 / 42.0, FBT_TOL(1e-6, 5e-3));
  }
}

/* E10.5, E10.6: a cantilever whose stiffness and mass fall linearly to half: deflection under a tip force, from
   int s^2/EI ds, and a rigid turn's energy, of few elements. */
TEST(tapered_beams_converge_fast)
{
  const double f = FBT_TOL(1e-8, 1e-3), closed_form = f * 2.0 * (log(2.0) - 0.5);
  for (int n = 1; n <= 4; n *= 2) {
    const double stiffness[6] = {0.0, 0.0, 0.0, 1.0, 1.0, 1.0}, inertia[6] = {1.0, 1.0, 1.0, 0.0, 0.0, 0.0};
    fb_energy energy;
    beam(1.0, n, stiffness, inertia);
    desc.n_station = 2;
    desc.station[1] = desc.station[0];
    desc.station[1].x = FB_R(1.0);
    for (int i = 0; i < 36; i++) {
      desc.station[1].stiffness[i] *= FB_R(0.5);
      desc.station[1].inertia[i] *= FB_R(0.5);
    }
    load_tip(FB_AXES_INERTIAL, 0.0, f, 0.0);
    settle();
    FBT_NEAR_REL(node[n].displacement[1], closed_form, FBT_TOL(n == 1 ? 2e-2 : n == 2 ? 2e-3 : 2e-4, 2e-2));
    memset(&input, 0, sizeof input);
    input.w[2] = FB_R(1.0);
    start();
    FBT_INT_EQ(fb_exact_energy_eval(&exact, &energy, &state), FB_OK);
    FBT_NEAR_REL(energy.kinetic, 0.5 * (1.0 / 3.0 - 0.5 / 4.0), FBT_TOL(1e-12, 1e-5)); /* 1/2 int (1 - x/2) x^2 */
  }
}

/* E10.12, E4.6: a tip moment makes an arc of which nodes and points in between are exact; three turns and more, and
   whole ones, where the attitude alone tells neither their number nor the axis. */
TEST(points_between_nodes_lie_on_the_curve)
{
  for (int k = 0; k < 6; k++) {
    const double M = 2.0 * pi * (1 + k / 2) + 0.1 * (k % 2);
    elastica(12);
    load_tip(FB_AXES_NODE, 0.0, 0.0, 0.0);
    input.load[0].torque[2] = (fb_real)M;
    settle();
    FBT_NEAR_ABS(node[12].rotation[2], M, FBT_TOL(1e-9, 2e-4));
    for (int j = 0; j <= 50; j++) {
      const double x = j / 50.0;
      fb_real p[3], q[4];
      FBT_INT_EQ(fb_exact_point_eval(&exact, p, q, &state, (fb_real)x), FB_OK);
      FBT_BELOW(distance(p, sin(M * x) / M, (1.0 - cos(M * x)) / M, 0.0), FBT_TOL(1e-10, 1e-5));
    }
  }
  elastica(4); /* bent by a load on the line: no gap before a node */
  for (int k = 0; k < 4; k++) {
    input.line[k].axes = FB_AXES_NODE;
    input.line[k].force[1] = FB_R(6.0);
    input.line[k].torque[2] = FB_R(2.0);
  }
  settle();
  for (int k = 1; k <= 4; k++) {
    const double before = 0.25 * k - FBT_TOL(1e-9, 1e-5);
    fb_real p[3], q[4];
    FBT_INT_EQ(fb_exact_point_eval(&exact, p, q, &state, (fb_real)before), FB_OK);
    FBT_BELOW(distance(p, (double)node[k].position[0], (double)node[k].position[1], 0.0), FBT_TOL(2e-9, 3e-5));
    FBT_BELOW(1.0 - fabs((double)(q[0] * node[k].quat[0] + q[3] * node[k].quat[3])), FBT_TOL(1e-14, 1e-6));
  }
  elastica(8); /* bent by a force: the middle of an element against a mesh twice as fine */
  load_tip(FB_AXES_NODE, 0.0, 4.0, 0.0);
  settle();
  {
    fb_real p[3], q[4];
    FBT_INT_EQ(fb_exact_point_eval(&exact, p, q, &state, FB_R(0.5625)), FB_OK);
    desc.n_element = 16;
    input.load[0].node = 16;
    settle();
    FBT_BELOW(distance(p, (double)node[9].position[0], (double)node[9].position[1], 0.0), FBT_TOL(5e-5, 1e-4));
  }
}

/* E10.12: a moment on a node amid: beyond it the line is straight, before it an arc. */
TEST(points_beside_a_loaded_node_know_its_load)
{
  elastica(4);
  load_tip(FB_AXES_NODE, 0.0, 0.0, 0.0);
  input.load[0].node = 2;
  input.load[0].torque[2] = FB_R(0.8);
  settle();
  for (int k = 0; k <= 20; k++) {
    const double x = k / 20.0, turn = 0.8 * (x < 0.5 ? x : 0.5);
    fb_real p[3], q[4];
    FBT_INT_EQ(fb_exact_point_eval(&exact, p, q, &state, (fb_real)x), FB_OK);
    FBT_NEAR_ABS(2.0 * atan2((double)q[3], (double)q[0]), turn, FBT_TOL(1e-12, 1e-5));
  }
}

/* E4.10: rotation vectors follow the beam through any number of whole turns, about any axis either way, from coarse
   nodes, too. */
TEST(rotations_follow_the_beam_through_whole_turns)
{
  elastica(FB_MAX_EXACT);
  start();
  fbt_seed(4);
  for (int run = 0; run < 12; run++) {
    const double step = run % 3 == 0 ? 0.5 * pi : run % 3 == 1 ? 0.4 : 2.3; /* [rad] from node to node */
    fb_real axis[3], wound[FB_MAX_EXACT + 1][3];
    double size;
    fbt_fill(axis, 3, 1.0);
    size = sqrt((double)fb_vec3_dot(axis, axis));
    for (int j = 0; j <= FB_MAX_EXACT; j++) {
      for (int i = 0; i < 3; i++) {
        wound[j][i] = (fb_real)(step * j / size) * axis[i];
      }
      fb_quat_from_rotvec(state.quat + 4 * j, wound[j]);
    }
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    for (int j = 0; j <= FB_MAX_EXACT; j++) {
      FBT_BELOW(fbt_difference(node[j].rotation, wound[j], 3), FBT_TOL(1e-12, 1e-3));
    }
  }
}

/* E4.3: the root's own rotation is within half a turn, either way about any axis. */
TEST(the_roots_rotation_is_within_half_a_turn)
{
  elastica(1);
  start();
  for (int k = 0; k < 6; k++) {
    fb_real turn[3] = {0, 0, 0};
    turn[k / 2] = k % 2 ? FB_R(3.0) : -FB_R(3.0);
    fb_quat_from_rotvec(state.quat, turn);
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    FBT_BELOW(fbt_difference(node[0].rotation, turn, 3), FBT_TOL(1e-14, 1e-5));
  }
}

/* E4.10: three elements wind a beam by a whole turn, but for a little about another axis: while that is very little,
   the rotation vector is next to the whole turn; in any case it is that of the attitude to a thousandth of a radian. */
TEST(rotations_next_to_a_whole_turn_are_those_of_the_attitude)
{
  elastica(3);
  start();
  for (int run = 0; run < 2; run++) {
    const fb_real off[3] = {0, run ? FB_R(0.0015) : FB_R(0.0001), 0};
    fb_real quat[4], turn[4], back[4], rotation[3];
    for (int j = 0; j <= 3; j++) {
      const fb_real wound[3] = {0, 0, (fb_real)(2.0 * pi * j / 3.0)};
      fb_quat_from_rotvec(state.quat + 4 * j, wound);
    }
    fb_quat_from_rotvec(turn, off);
    memcpy(quat, state.quat + 12, sizeof quat);
    fb_quat_mul(state.quat + 12, quat, turn);
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    FBT_TRUE(run == 1 || distance(node[3].rotation, 0.0, 0.0, 2.0 * pi) < 1e-3);
    fb_quat_from_rotvec(quat, node[3].rotation);
    for (int i = 0; i < 4; i++) {
      back[i] = i ? -state.quat[12 + i] : state.quat[12];
    }
    fb_quat_mul(turn, back, quat);
    fb_quat_to_rotvec(rotation, turn);
    FBT_BELOW(fbt_largest(rotation, 3), 1e-3);
  }
}

/* E10.12: between nodes, too, a cantilever under a small force F at its tip has turned by F (L x - x^2/2)/EI. */
TEST(turns_between_nodes_are_those_of_a_cantilever)
{
  const double f = FBT_TOL(1e-6, 1e-2);
  elastica(2);
  load_tip(FB_AXES_INERTIAL, 0.0, f, 0.0);
  settle();
  for (int k = 1; k <= 8; k++) {
    const double x = k / 8.0;
    fb_real p[3], q[4];
    FBT_INT_EQ(fb_exact_point_eval(&exact, p, q, &state, (fb_real)x), FB_OK);
    FBT_NEAR_REL(2.0 * atan2((double)q[3], (double)q[0]), f * (x - 0.5 * x * x), FBT_TOL(1e-6, 1e-3));
  }
}

/* E10.11: the 45-degree bend against a shooting solution and the published tip. */
TEST(steady_bend_of_an_arc_matches_the_published_tip)
{
  const fbt_table *t = fbt_reference("p05_bend45.csv");
  const double published[3][4] = {
      {300.0, 22.33, 58.84, 40.08}, {450.0, 18.62, 52.32, 48.39}, {600.0, 15.79, 47.23, 53.37}};
  const double EI = 1e7 / 12.0, saint_venant = 5e6 * 0.14057701;
  double worst = 0.0;
  for (int row = 0; row < t->rows; row++) {
    const int other = strcmp(fbt_word(t, row, "variant"), "literature") != 0;
    const double P = fbt_value(t, row, "P"), GJ = other ? saint_venant : EI;
    const double shear = strcmp(fbt_word(t, row, "variant"), "sv_shear56") == 0 ? 5e6 * 5.0 / 6.0 : 5e6;
    const double stiffness[6] = {1e7, shear, shear, GJ, EI, EI};
    double error;
    if (strcmp(fbt_word(t, row, "variant"), "rigid_shear_axial") == 0) {
      continue;
    }
    beam(25.0 * pi, 40, stiffness, NULL);
    desc.station[0].curvature[2] = FB_R(-0.01);
    desc.attitude[0] = desc.attitude[3] = FB_R(0.7071067811865476);
    load_tip(FB_AXES_INERTIAL, 0.0, 0.0, P);
    settle();
    error = distance(node[40].position, fbt_value(t, row, "x"), fbt_value(t, row, "y"), fbt_value(t, row, "z"));
    FBT_BELOW(error / 78.54, FBT_TOL(1e-6, 1e-5));
    worst = error / 78.54 > worst ? error / 78.54 : worst;
    for (int i = 0; i < 3 && !other; i++) { /* eight straight elements then: within a hundredth of the length */
      if ((int)published[i][0] == (int)P) {
        FBT_BELOW(distance(node[40].position, published[i][1], published[i][2], published[i][3]) / 78.54, 3e-3);
      }
    }
  }
  fbt_figure("45-degree bend, tip under 300 to 600, 40 elements, of the length", "shooting", worst);
}

/* E10.11: [L] 4.4 and 4.6 against shooting: follower force and loads, at rest and at 3 Hz, root loads. */
TEST(steady_rotation_with_load_matches_shooting)
{
  const fbt_table *t = fbt_reference("p03_rotating_loaded.csv");
  const double rho = 0.098 / 386.4;
  for (int row = 0; row < t->rows; row++) {
    const char *model = fbt_word(t, row, "model");
    const int rigid = strcmp(model, "elastica") == 0, shear = strcmp(model, "reissner") == 0;
    const double stiffness[6] = {rigid ? 0.0 : 6e7, shear ? 6e7 / 2.7 : 0.0, shear ? 6e7 / 2.7 : 0.0, 1e7, 5e6, 1.8e8};
    const double inertia[6] = {6.0 * rho, 6.0 * rho, 6.0 * rho, 0.0, 0.0, 0.0};
    beam(72.0, 40, stiffness, inertia);
    input.w[2] = (fb_real)(2.0 * pi * fbt_value(t, row, "f_Hz"));
    for (int k = 0; k < 40; k++) {
      input.line[k].axes = FB_AXES_NODE;
      input.line[k].force[2] = FB_R(50.0);
    }
    settle();
    FBT_NEAR_ABS(node[40].displacement[0], fbt_value(t, row, "ux_tip"), FBT_TOL(7e-4, 2e-3)); /* of 72 in */
    FBT_NEAR_ABS(node[40].displacement[2], fbt_value(t, row, "uz_tip"), FBT_TOL(7e-4, 2e-3));
    FBT_NEAR_ABS(node[40].rotation[1], -fbt_value(t, row, "theta_tip"), FBT_TOL(1e-5, 1e-4));
    FBT_NEAR_REL(node[0].force[0], fbt_value(t, row, "H_root"), FBT_TOL(2e-2, 2e-2));
    FBT_NEAR_REL(node[0].force[2], fbt_value(t, row, "V_root"), FBT_TOL(1e-4, 1e-3));
    FBT_NEAR_REL(-node[0].moment[1], fbt_value(t, row, "M_root"), FBT_TOL(1e-4, 1e-3));
  }
}

/* E10.8: a spinning rod stretches as in closed form: all places, six cases and one with a hub. */
TEST(steady_stretch_of_a_spinning_rod_is_the_closed_form)
{
  const fbt_table *t = fbt_reference("p03_rotating_rod.csv");
  const double rho = 0.098 / 386.4;
  for (int row = 0; row < t->rows; row++) {
    const char *name = fbt_word(t, row, "case");
    const double E = strcmp(name, "leigh12_elastic") == 0 ? 1000.0 : 1e7,
                 L = strcmp(name, "leigh72") == 0 ? 72.0 : 12.0;
    const double stiffness[6] = {2.0 * E, 0.0, 0.0, E, E / 6.0, E / 6.0};
    const double inertia[6] = {2.0 * rho, 2.0 * rho, 2.0 * rho, 0.0, 0.0, 0.0};
    const double x = fbt_value(t, row, "x"), u = fbt_value(t, row, "u");
    const double w = 2.0 * pi * fbt_value(t, row, "f_Hz");
    fb_real p[3], q[4];
    if (row == 0 || x <= 0.0) {
      beam(L, 40, stiffness, inertia);
      desc.position[0] = (fb_real)fbt_value(t, row, "hub");
      input.w[2] = (fb_real)w;
      settle();
    }
    FBT_INT_EQ(fb_exact_point_eval(&exact, p, q, &state, (fb_real)x), FB_OK);
    FBT_NEAR_ABS((double)p[0] - (double)desc.position[0] - x, u, FBT_TOL(5e-4 * u + 1e-14, 1e-2 * u + 3e-6 * L));
  }
}

/* E10.11: Princeton beam experiment (as an ANSYS beam model) at all angles. */
TEST(steady_princeton_beam_at_all_angles)
{
  const fbt_table *t = fbt_reference("princeton_beam.csv");
  const double E = 71.7e9, G = E / 2.62, h = 12.3777e-3, b = 3.2024e-3, strong = b * h * h * h / 12.0,
               weak = h * b * b * b / 12.0;
  const double stiffness[6] = {
      E * b * h, G * b * h * 5.0 / 6.0, G * b * h * 5.0 / 6.0, 0.198 * (strong + weak) * G, E * weak, E * strong};
  double worst = 0.0;
  for (int row = 0; row < t->rows; row++) {
    const double a = fbt_value(t, row, "beta") * pi / 180.0, y = fbt_value(t, row, "tip_y"),
                 z = fbt_value(t, row, "tip_z"), size = sqrt(y * y + z * z);
    double error;
    beam(0.508, 10, stiffness, NULL);
    load_tip(FB_AXES_INERTIAL, 0.0, 8.896 * cos(a), 8.896 * sin(a));
    settle();
    error = hypot((double)node[10].displacement[1] - y, (double)node[10].displacement[2] - z) / size;
    FBT_BELOW(error, 0.01);
    worst = error > worst ? error : worst;
  }
  fbt_figure("Princeton beam, all angles, tip displacement", "ANSYS beam model", worst);
}

/* Shooting for a hanging cantilever: (rotation, moment, x, z) from the root on by a moment there, Runge-Kutta. The load
   of what hangs below is known, so that one number is sought. */
static void hang(double y[4], double root, double EA, double EI, double q, double L)
{
  const int n = 4000;
  const double h = L / n;
  y[0] = y[2] = y[3] = 0.0;
  y[1] = root;
  for (int i = 0; i < n && fabs(y[0]) < 20.0; i++) {
    double k[5][4] = {{0.0}}, sum[4] = {0.0};
    for (int s = 1; s <= 4; s++) {
      const double c = s == 1 ? 0.0 : s == 4 ? 1.0 : 0.5, weight = s == 1 || s == 4 ? 1.0 : 2.0;
      const double a = y[0] + c * h * k[s - 1][0], M = y[1] + c * h * k[s - 1][1];
      const double F = q * (L - (i + c) * h), e = 1.0 + F * sin(a) / EA, g = F * cos(a) / EA; /* GA = EA */
      k[s][0] = M / EI;
      k[s][2] = e * cos(a) - g * sin(a);
      k[s][3] = -(e * sin(a) + g * cos(a));
      k[s][1] = -F * k[s][2];
      for (int j = 0; j < 4; j++) {
        sum[j] += weight * k[s][j];
      }
    }
    for (int j = 0; j < 4; j++) {
      y[j] += h / 6.0 * sum[j];
    }
  }
}

/* Virtual work of one planar element of order 5 (displacements and angle at the Gauss-Lobatto nodes, the first held)
   with six Gauss points, hanging by a part of its weight: r of the nodes' (u, w, angle). */
static void one_element(double *r, const double *x, double part, double EA, double EI, double weight, double length)
{
  static const double node_at[6] = {-1.0, -0.765055323929465, -0.285231516480645, 0.285231516480645, 0.765055323929465,
                                    1.0};
  static const double at[6] = {-0.932469514203152, -0.661209386466265, -0.238619186083197,
                               0.238619186083197,  0.661209386466265,  0.932469514203152};
  static const double share[6] = {0.171324492379170, 0.360761573048139, 0.467913934572691,
                                  0.467913934572691, 0.360761573048139, 0.171324492379170};
  memset(r, 0, 15 * sizeof *r);
  for (int g = 0; g < 6; g++) {
    const double half = 0.5 * length;
    double N[6], dN[6], y[3] = {0.0, 0.0, 0.0}, dy[3] = {0.0, 0.0, 0.0};
    for (int a = 0; a < 6; a++) {
      N[a] = 1.0;
      dN[a] = 0.0;
      for (int b = 0; b < 6; b++) {
        if (b != a) {
          dN[a] = (dN[a] * (at[g] - node_at[b]) + N[a]) / (node_at[a] - node_at[b]);
          N[a] *= (at[g] - node_at[b]) / (node_at[a] - node_at[b]);
        }
      }
      for (int i = 0; i < 3 && a > 0; i++) {
        y[i] += N[a] * x[3 * (a - 1) + i];
        dy[i] += dN[a] / half * x[3 * (a - 1) + i];
      }
    }
    {
      const double c = cos(y[2]), s = sin(y[2]), stretch = c * (1.0 + dy[0]) + s * dy[1];
      const double shear = c * dy[1] - s * (1.0 + dy[0]), pull = EA * (stretch - 1.0), across = EA * shear;
      for (int a = 1; a < 6; a++) {
        double *const row = r + 3 * (a - 1);
        row[0] += share[g] * dN[a] * (pull * c - across * s);
        row[1] += share[g] * (dN[a] * (pull * s + across * c) - half * N[a] * part * weight);
        row[2] += share[g] * (dN[a] * EI * dy[2] + half * N[a] * (pull * shear - across * stretch));
      }
    }
  }
}

/* Tip displacement (u, w) of that element in equilibrium, by Newton's method in a hundred load steps. */
static void one_element_hang(double tip[2], double EA, double EI, double weight, double length)
{
  fb_real A[225], row_scale[15], b[15], correction[15];
  int order[15];
  double x[15] = {0}, r[15], moved[15];
  for (int load = 1; load <= 100; load++) {
    for (int k = 0; k < 8; k++) {
      one_element(r, x, load / 100.0, EA, EI, weight, length);
      for (int j = 0; j < 15; j++) {
        const double was = x[j];
        x[j] += 1e-6;
        one_element(moved, x, load / 100.0, EA, EI, weight, length);
        x[j] = was;
        for (int i = 0; i < 15; i++) {
          A[15 * i + j] = (fb_real)((moved[i] - r[i]) / 1e-6);
        }
        b[j] = (fb_real)-r[j];
      }
      FBT_INT_EQ(fb_lu_factor(A, order, row_scale, 15), FB_OK);
      fb_lu_solve(correction, A, order, b, 15);
      for (int i = 0; i < 15; i++) {
        x[i] += (double)correction[i];
      }
    }
  }
  tip[0] = x[12];
  tip[1] = x[13];
}

/* E10.7: OpenFAST's cantilever under its weight (r-test bd_static_cantilever_beam) against shooting. The published
   figures are those of one element of order 5 with six Gauss points, which the boundary layer at the root (a tenth of
   the length) is too short for: 9.060 m for 9.418 m. The check against them says so, and has them from such an
   element. */
TEST(steady_openfast_cantilever_hangs_as_shooting_says)
{
  const fbt_table *t = fbt_reference("beamdyn_static_cantilever.csv");
  const double soft[6] = {1e4, 1e4, 1e4, 200.0, 100.0, 100.0}, mass[6] = {1.0, 1.0, 1.0, 0.0, 0.0, 0.0};
  double low = 135.0, high = 136.0, y[4], coarse[2];
  for (int k = 0; k < 40; k++) {
    hang(y, 0.5 * (low + high), 1e4, 100.0, 9.806, 10.0);
    low = y[1] < 0.0 ? 0.5 * (low + high) : low;
    high = y[1] < 0.0 ? high : 0.5 * (low + high);
  }
  beam(10.0, 20, soft, mass); /* x here is z there, z here is -x */
  desc.gravity[2] = FB_R(-9.806);
  settle();
  FBT_NEAR_REL(node[20].displacement[2], y[3], 1e-4);
  FBT_NEAR_REL(node[20].displacement[0], y[2] - 10.0, 1e-4);
  FBT_NEAR_REL(node[20].wiener_milenkovic[1], 4.0 * tan(y[0] / 4.0), 1e-4);
  FBT_NEAR_REL(-node[0].force[2], 98.06, 1e-3);
  fbt_figure("OpenFAST's cantilever under its weight, 20 elements, tip, relative", "shooting",
             fabs((double)node[20].displacement[2] / y[3] - 1.0));
  one_element_hang(coarse, 1e4, 100.0, 9.806, 10.0);
  FBT_NEAR_REL(coarse[1], fbt_value(t, 0, "value"), 1e-3);
  FBT_NEAR_REL(coarse[0], fbt_value(t, 1, "value"), 1e-3);
  fbt_figure("the same tip, one fifth-order element as published", "shooting",
             fabs(fbt_value(t, 0, "value") / -y[3] - 1.0));
}

/* ---- sections, ends, units */

/* E10.4: strain of a section with centers off the line, twisted: force through the tension center stretches without
   bending, force through the shear center bends without twisting, inertia about the line is by Steiner. */
TEST(offsets_of_a_section_are_those_of_the_forces)
{
  fb_section section;
  const double f = FBT_TOL(1e-3, 10.0);
  memset(&section, 0, sizeof section);
  section.mass = FB_R(2.0);
  section.EA = FB_R(1e4);
  section.GJ = FB_R(100.0);
  section.EI_y = FB_R(50.0);
  section.EI_z = FB_R(70.0);
  section.GA_y = section.GA_z = FB_R(1e4);
  section.i_y = FB_R(0.2);
  section.i_z = FB_R(0.3);
  section.tension_y = FB_R(0.1);
  section.tension_z = FB_R(-0.2);
  section.shear_y = FB_R(0.05);
  section.shear_z = FB_R(0.07);
  section.mass_y = FB_R(0.3);
  section.mass_z = FB_R(-0.4);
  elastica(4);
  FBT_INT_EQ(fb_exact_station_init(&desc.station[0], &section), FB_OK);
  FBT_NEAR_REL(desc.station[0].inertia[21], 0.5 + 2.0 * 0.25, FBT_TOL(1e-14, 1e-6)); /* polar */
  FBT_NEAR_REL(desc.station[0].inertia[28], 0.2 + 2.0 * 0.16, FBT_TOL(1e-14, 1e-6));
  FBT_NEAR_REL(desc.station[0].inertia[35], 0.3 + 2.0 * 0.09, FBT_TOL(1e-14, 1e-6));
  FBT_NEAR_REL(desc.station[0].inertia[29], 2.0 * 0.12, FBT_TOL(1e-14, 1e-6)); /* - int y z dm */
  load_tip(FB_AXES_NODE, f, 0.0, 0.0);
  input.load[0].torque[1] = (fb_real)(-0.2 * f); /* r x F of (0.1, -0.2) */
  input.load[0].torque[2] = (fb_real)(-0.1 * f);
  settle();
  FBT_NEAR_REL(node[4].displacement[0], f / 1e4, FBT_TOL(1e-9, 1e-3));
  FBT_NEAR_ABS(node[4].rotation[1], 0.0, FBT_TOL(1e-12, 1e-8));
  FBT_NEAR_ABS(node[4].rotation[2], 0.0, FBT_TOL(1e-12, 1e-8));
  memset(&input, 0, sizeof input);
  load_tip(FB_AXES_INERTIAL, 0.0, 0.01 * f, 0.02 * f);
  input.load[0].torque[0] = (fb_real)(0.01 * f * (0.05 * 2.0 - 0.07));
  settle();
  FBT_NEAR_ABS(node[4].rotation[0], 0.0, FBT_TOL(1e-9, 1e-5));
  FBT_NEAR_REL(node[4].rotation[2], 0.01 * f * 0.5 / 70.0, FBT_TOL(1e-3, 1e-2));
  section.EI_y = section.EI_z = FB_R(0.0); /* rigid in bending, though pulls off the line would bend */
  FBT_INT_EQ(fb_exact_station_init(&desc.station[0], &section), FB_OK);
  FBT_TRUE(fbt_largest(desc.station[0].stiffness + 24, 12) == 0.0);
  for (int i = 0; i < 4; i++) { /* of what is not rigid nothing is lost */
    const double expected[4] = {1e4, 1e4, 1e4, 100.0 + 1e4 * (0.05 * 0.05 + 0.07 * 0.07)};
    FBT_NEAR_REL(desc.station[0].stiffness[7 * i], expected[i], FBT_TOL(1e-14, 1e-6));
    FBT_TRUE(fbt_largest(desc.station[0].stiffness + 6 * i + 4, 2) == 0.0);
  }
}

/* E10.4: neither stiffness nor inertia is negative. */
TEST(sections_below_zero_are_refused)
{
  static fb_section section;
  fb_real *const field[] = {&section.mass, &section.EA,  &section.GJ,   &section.EI_y, &section.EI_z,
                            &section.i_y,  &section.i_z, &section.GA_y, &section.GA_z};
  for (int k = 0; k < FBT_COUNT(field); k++) {
    fb_exact_station station;
    memset(&section, 0, sizeof section);
    section.i_y = section.i_z = FB_R(2.0); /* so that their sum does not tell */
    FBT_INT_EQ(fb_exact_station_init(&station, &section), FB_OK);
    *field[k] = -FB_R(1.0);
    FBT_INT_EQ(fb_exact_station_init(&station, &section), FB_ERR_VALUE);
  }
}

/* E10.5: a straight beam that nothing bends is twisted as its stations say, at nodes and between, from root to tip. */
TEST(twist_is_that_of_the_stations)
{
  const double at[3] = {0.0, 0.7, 2.0}, twist[3] = {0.3, -0.4, 0.9};
  const double stiffness[6] = {1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
  for (int uneven = 0; uneven < 2; uneven++) {
    beam(2.0, 4, stiffness, NULL);
    desc.n_station = 3;
    for (int k = 0; k < 3; k++) {
      desc.station[k] = desc.station[0];
      desc.station[k].x = (fb_real)at[k];
      desc.station[k].twist = (fb_real)twist[k];
    }
    for (int k = 1; k <= 4 && uneven; k++) { /* one at a station */
      const double place[4] = {0.2, 0.7, 1.1, 2.0};
      desc.place[k] = (fb_real)place[k - 1];
    }
    start();
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    for (int k = 0; k <= 4; k++) {
      const double x = uneven ? (double)desc.place[k] : 0.5 * k;
      const int b = x > at[1] ? 2 : 1;
      const double expected = twist[b - 1] + (twist[b] - twist[b - 1]) * (x - at[b - 1]) / (at[b] - at[b - 1]);
      fb_real p[3], q[4];
      FBT_NEAR_ABS(2.0 * atan2((double)node[k].quat[1], (double)node[k].quat[0]), expected, FBT_TOL(1e-13, 1e-5));
      FBT_INT_EQ(fb_exact_point_eval(&exact, p, q, &state, (fb_real)x), FB_OK);
      FBT_NEAR_ABS(2.0 * atan2((double)q[1], (double)q[0]), expected, FBT_TOL(1e-13, 1e-5));
      FBT_BELOW(distance(p, x, 0.0, 0.0), FBT_TOL(1e-13, 1e-5));
    }
  }
}

/* E10.5: at the nodes a beam has turned by the integral of its curvature, which is linear between stations, about each
   axis. */
TEST(curves_are_those_of_the_stations)
{
  const double at[3] = {0.0, 0.7, 2.0}, curvature[3] = {0.3, -0.5, 0.8};
  const double stiffness[6] = {1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
  for (int axis = 0; axis < 3; axis++) {
    beam(2.0, 4, stiffness, NULL);
    desc.n_station = 3;
    for (int k = 0; k < 3; k++) {
      desc.station[k] = desc.station[0];
      desc.station[k].x = (fb_real)at[k];
      desc.station[k].curvature[axis] = (fb_real)curvature[k];
    }
    start();
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    for (int k = 0; k <= 4; k++) {
      const double x = 0.5 * k;
      double turned = 0.0;
      for (int b = 1; b < 3; b++) {
        const double part = fmin(fmax((x - at[b - 1]) / (at[b] - at[b - 1]), 0.0), 1.0);
        turned += (at[b] - at[b - 1]) * part * (curvature[b - 1] + 0.5 * part * (curvature[b] - curvature[b - 1]));
      }
      FBT_NEAR_ABS(2.0 * atan2((double)node[k].quat[1 + axis], (double)node[k].quat[0]), turned, FBT_TOL(1e-13, 1e-5));
    }
  }
}

/* E11.20: the same beam in other units of length, force and time gives the same motion. */
TEST(any_units_give_the_same_solution)
{
  const double units[4][3] = {
      {1.0, 1.0, 1.0}, {1e-3, 1e3, FBT_TOL(1e3, 10.0)}, {39.37, 0.2248, FBT_TOL(1e-3, 0.1)}, {1e3, 1e-4, 1.0}};
  double reference[3] = {0.0, 0.0, 0.0}, tip = 0.0;
  for (int u = 0; u < 4; u++) {
    const double l = units[u][0], f = units[u][1], t = units[u][2], mass = f * t * t / l; /* one old in new ones */
    const double stiffness[6] = {1e6 * f, 4e5 * f, 4e5 * f, 80.0 * f * l * l, 100.0 * f * l * l, 300.0 * f * l * l};
    const double inertia[6] = {mass / l, mass / l, mass / l, 2e-3 * mass * l, 1e-3 * mass * l, 1e-3 * mass * l};
    beam(10.0 * l, 10, stiffness, inertia);
    load_tip(FB_AXES_NODE, 0.0, 2.0 * f, 8.0 * f);
    input.w[2] = (fb_real)(1.0 / t);
    settle();
    if (u == 0) {
      for (int i = 0; i < 3; i++) {
        reference[i] = (double)node[10].displacement[i];
      }
    }
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(node[10].displacement[i] / (fb_real)l, reference[i], FBT_TOL(1e-10, 1e-3));
    }
    input.n_load = 0;
    for (int k = 0; k < 50; k++) {
      FBT_INT_EQ(fb_exact_step(&exact, &state, &work, &input, (fb_real)(0.01 * t)), FB_OK);
    }
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    tip = u == 0 ? (double)node[10].displacement[2] : tip;
    FBT_NEAR_ABS(node[10].displacement[2] / (fb_real)l, tip, FBT_TOL(1e-9, 1e-2));
  }
}

/* E10.3: the units of a beam's own are its length, the force that bends it (twists, stretches, where it does nothing
   else) by its length, and the time in which that force moves its mass with its bodies. */
TEST(units_are_the_beams_own)
{
  static const double stiffness[3][6] = {
      {9.0, 8.0, 7.0, 5.0, 4.0, 3.0}, {9.0, 8.0, 7.0, 5.0, 0.0, 0.0}, {9.0, 8.0, 7.0}};
  const double inertia[6] = {0.1, 0.1, 0.1, 0.02, 0.01, 0.01};
  const double force[3] = {3.0 / 4.0, 5.0 / 4.0, 7.0};
  for (int run = 0; run < 3; run++) {
    beam(2.0, 4, stiffness[run], inertia);
    desc.n_lump = 2;
    desc.lump[0].mass = FB_R(0.3);
    desc.lump[1].mass = FB_R(0.2);
    start();
    FBT_NEAR_REL(exact.length, 2.0, FBT_TOL(1e-14, 1e-6));
    FBT_NEAR_REL(exact.force, force[run], FBT_TOL(1e-14, 1e-6));
    FBT_NEAR_REL(exact.time, sqrt((2.0 * 0.1 + 0.5) * 2.0 / force[run]), FBT_TOL(1e-14, 1e-6));
  }
}

/* E10.5, E10.12: the last station, and a point, are on the beam where they are off its end by rounding of their
   file. */
TEST(ends_are_met_to_rounding)
{
  fb_real p[3], q[4];
  elastica(3);
  desc.n_station = 2;
  desc.station[0].twist = FB_R(0.3);
  desc.station[1] = desc.station[0];
  desc.station[1].x = FB_R(0.999994);
  load_tip(FB_AXES_INERTIAL, 0.0, FBT_TOL(1e-6, 1e-3), 0.0);
  settle();
  FBT_NEAR_REL(node[3].displacement[1], FBT_TOL(1e-6, 1e-3) / 3.0, FBT_TOL(1e-10, 1e-3));
  FBT_NEAR_ABS(2.0 * atan2((double)node[3].quat[1], (double)node[3].quat[0]), 0.3, 1e-3);
  FBT_INT_EQ(fb_exact_point_eval(&exact, p, q, &state, FB_R(1.000006)), FB_OK);
  FBT_BELOW(distance(p, (double)node[3].position[0], (double)node[3].position[1], 0.0), 1e-5);
}

/* E10.11: loads in inertial axes are taken as they stand: of a beam without mass the spin of its base changes
   nothing. */
TEST(dead_loads_do_not_spin_with_the_base)
{
  const double stiffness[6] = {100.0, 50.0, 60.0, 2.0, 5.0, 7.0};
  fb_real still[3];
  for (int spins = 0; spins < 2; spins++) {
    beam(1.0, 4, stiffness, NULL);
    load_tip(FB_AXES_INERTIAL, 1.0, 3.0, -2.0);
    input.w[0] = spins ? FB_R(0.7) : FB_R(0.0);
    input.w[1] = spins ? FB_R(0.4) : FB_R(0.0);
    settle();
    if (!spins) {
      memcpy(still, node[4].displacement, sizeof still);
    }
  }
  FBT_BELOW(0.1, fbt_largest(still, 3));
  FBT_BELOW(fbt_difference(still, node[4].displacement, 3), FBT_TOL(1e-12, 1e-5));
}

/* Deflection of the middle under a line load q, for the supports of a beam. */
static double sag(int root, int tip, double q)
{
  elastica(20);
  desc.root = root;
  desc.tip = tip;
  for (int k = 0; k < 20; k++) {
    input.line[k].force[2] = (fb_real)q;
  }
  settle();
  return (double)node[10].displacement[2] / q;
}

/* E10.10: ends and supports against the textbook's beams; a support amid the beam, and its reaction. */
TEST(supports_are_those_of_the_textbook)
{
  const double q = FBT_TOL(1e-4, 1e-3);
  FBT_NEAR_REL(sag(FB_END_PINNED | FB_HOLD_RX, FB_HOLD_Y | FB_HOLD_Z, q), 5.0 / 384.0, FBT_TOL(1e-5, 1e-3));
  FBT_NEAR_REL(sag(FB_END_CLAMPED, FB_END_SLIDING & ~FB_HOLD_RX, q), 1.0 / 384.0, FBT_TOL(1e-5, 1e-2));
  FBT_NEAR_REL(sag(FB_END_CLAMPED, FB_HOLD_Z, q), 1.0 / 192.0, FBT_TOL(1e-5, 1e-2));
  FBT_NEAR_REL(sag(FB_END_CLAMPED, FB_END_GUIDED, q), 9.0 / 384.0, FBT_TOL(1e-5, 1e-2));
  elastica(20); /* three supports: the middle one takes 5/8 of the load */
  desc.root = FB_END_PINNED | FB_HOLD_RX;
  desc.tip = FB_HOLD_Y | FB_HOLD_Z;
  desc.n_support = 1;
  desc.support[0].node = 10;
  desc.support[0].held = FB_HOLD_Z;
  for (int k = 0; k < 20; k++) {
    input.line[k].force[2] = (fb_real)q;
  }
  settle();
  FBT_NEAR_REL(node[0].force[2], q * 3.0 / 16.0, FBT_TOL(1e-4, 1e-2));
  FBT_NEAR_REL(node[0].reaction_force[2], -q * 3.0 / 16.0, FBT_TOL(1e-4, 1e-2));
  FBT_NEAR_REL(node[10].reaction_force[2], -q * 5.0 / 8.0, FBT_TOL(1e-4, 1e-2));
}

/* E10.10: pinned, and guided ends of a bent beam: large deflection of a beam that slides over its support. */
TEST(a_beam_slides_over_its_support)
{
  elastica(30);
  desc.root = FB_END_PINNED | FB_HOLD_RX;
  desc.tip = FB_HOLD_Y | FB_HOLD_Z;
  input.n_load = 1;
  input.load[0].node = 15;
  input.load[0].force[2] = FB_R(-40.0);
  settle();
  FBT_NEAR_ABS(node[30].displacement[2], 0.0, FBT_TOL(1e-12, 1e-5));
  FBT_NEAR_ABS(node[30].rotation[1], -(double)node[0].rotation[1], FBT_TOL(1e-9, 1e-3));
  { /* half of it is a cantilever whose tip is pushed across its final direction at the support */
    const double sink = -(double)node[15].displacement[2], half = (double)node[15].position[0];
    const double slope = -(double)node[0].rotation[1];
    elastica(15);
    desc.length = FB_R(0.5);
    load_tip(FB_AXES_INERTIAL, 0.0, 0.0, 20.0);
    settle();
    FBT_NEAR_ABS(node[15].displacement[2], sink, FBT_TOL(1e-6, 1e-3));
    FBT_NEAR_ABS(node[15].position[0], half, FBT_TOL(1e-6, 1e-3));
    FBT_NEAR_ABS(-node[15].rotation[1], fabs(slope), FBT_TOL(1e-6, 1e-3));
  }
}

/* E10.9, E10.10: everything at once (centers off the line, twist, curvature, lumped body, spin, gravity, dead and
   follower loads on nodes and elements, a support that slides): from a solution nearby four corrections reach rounding.
   Terms too small for that to show are compared one by one by tests/checks/jacobian.c. */
TEST(newton_converges_quadratically)
{
  const fb_section section = {FB_R(0.0),   FB_R(1.0),  FB_R(900.0), FB_R(1.4),   FB_R(1.0),  FB_R(3.0),
                              FB_R(0.02),  FB_R(0.04), FB_R(900.0), FB_R(800.0), FB_R(0.0),  FB_R(0.1),
                              FB_R(-0.15), FB_R(0.02), FB_R(0.01),  FB_R(0.012), FB_R(0.008)};
  for (int run = 0; run < 2; run++) {
    elastica(8);
    FBT_INT_EQ(fb_exact_station_init(&desc.station[0], &section), FB_OK);
    desc.station[0].curvature[0] = FB_R(0.5);
    desc.station[0].curvature[1] = FB_R(-0.3);
    desc.gravity[1] = FB_R(-1.0);
    desc.gravity[2] = FB_R(2.0);
    desc.n_lump = 1;
    desc.lump[0].node = 5;
    desc.lump[0].mass = FB_R(0.4);
    desc.lump[0].center[1] = FB_R(0.2);
    desc.lump[0].inertia[0] = desc.lump[0].inertia[1] = desc.lump[0].inertia[2] = FB_R(0.01);
    desc.tip = run ? FB_HOLD_Y : FB_END_FREE;
    input.w[0] = FB_R(0.3);
    input.w[2] = FB_R(1.2);
    input.v[1] = FB_R(0.5);
    load_tip(FB_AXES_INERTIAL, 0.3, -0.5, 0.4);
    load_tip(FB_AXES_NODE, 0.3, 0.2, 0.4);
    load_tip(FB_AXES_BODY, 0.1, 0.2, -0.4);
    input.load[0].torque[0] = input.load[1].torque[1] = FB_R(0.2);
    for (int k = 0; k < 8; k++) {
      input.line[k].axes = k % 3 == 0 ? FB_AXES_INERTIAL : k % 3 == 1 ? FB_AXES_NODE : FB_AXES_BODY;
      input.line[k].force[k % 2 + 1] = FB_R(0.6);
      input.line[k].torque[0] = input.line[k].torque[2] = FB_R(-0.1);
    }
    settle();
    for (int l = 0; l < 3; l++) {
      input.load[l].force[1] += FB_R(0.05);
    }
    input.w[2] += FB_R(0.05);
    input.line[3].force[2] += FB_R(0.05);
    FBT_INT_EQ(fb_exact_trim(&exact, &state, &work, &input), FB_OK);
    FBT_INT_EQ(work.increments, 1);
    FBT_TRUE(work.iterations <= 4);
  }
}

/* E10.11: neighbors do not turn by more than a radian against each other at once: a moment at the tip bends or twists
   the one long element of five by a little more, which takes increments of the load, or a little less. */
TEST(large_turns_take_increments)
{
  for (int k = 0; k < 5; k++) {
    for (int axis = 0; axis < 3; axis++) {
      for (int less = 0; less < 2; less++) {
        elastica(5);
        for (int j = 1; j <= 5; j++) {
          desc.place[j] = (fb_real)((j + (j > k ? 5 : 0)) / 10.0);
        }
        load_tip(FB_AXES_NODE, 0.0, 0.0, 0.0);
        input.load[0].torque[axis] = less ? -FB_R(1.6) : FB_R(1.75); /* on 0.6 of the length */
        settle();
        FBT_INT_EQ(work.increments == 1, less);
        FBT_NEAR_REL(node[5].rotation[axis], input.load[0].torque[axis], FBT_TOL(1e-9, 1e-4));
      }
    }
  }
}

/* ---- the same beam seen another way: 1: with y for z, turned by a right angle about its line, 2: from its other end,
   turned by half a turn about z */

/* E10.8: rotations are those from the undeformed section, of a curved and twisted beam, too; held in the attitude that
   it was made with, at the tip, too, it stays so. */
TEST(undeformed_nodes_have_not_turned)
{
  for (int held = 0; held < 2; held++) {
    any_beam(0, 1);
    desc.station[1].twist = FB_R(0.8);
    desc.gravity[0] = desc.gravity[1] = desc.gravity[2] = FB_R(0.0);
    desc.n_lump = 0;
    memset(desc.lump, 0, sizeof desc.lump);
    memset(&input, 0, sizeof input);
    desc.tip = held ? FB_END_CLAMPED : FB_END_FREE;
    start();
    if (held) {
      settle();
    }
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    for (int j = 0; j <= 6; j++) {
      FBT_BELOW(fbt_largest(node[j].displacement, 3), FBT_TOL(1e-15, 1e-6));
      FBT_BELOW(fbt_largest(node[j].rotation, 3), FBT_TOL(1e-15, 1e-6));
      FBT_BELOW(fbt_largest(node[j].wiener_milenkovic, 3), FBT_TOL(1e-15, 1e-6));
    }
  }
}

/* E10.6: fields of an element in units that are not the beam's own; dead loads on a base that is turned. */
TEST(element_fields_have_their_units)
{
  const double stiffness[6] = {200.0, 80.0, 80.0, 30.0, 50.0, 70.0}, inertia[6] = {3.0, 3.0, 3.0, 0.1, 0.2, 0.3};
  fb_exact_element e;
  beam(4.0, 2, stiffness, inertia);
  input.w[2] = FB_R(0.5);
  start();
  FBT_INT_EQ(fb_exact_element_eval(&exact, &e, &state, 1), FB_OK);
  FBT_NEAR_REL(e.velocity[1], 0.5 * 3.0, FBT_TOL(1e-12, 1e-5));
  FBT_NEAR_REL(e.angular_rate[2], 0.5, FBT_TOL(1e-12, 1e-5));
  FBT_NEAR_REL(e.momentum[1], 3.0 * 1.5, FBT_TOL(1e-12, 1e-5));
  FBT_NEAR_REL(e.angular_momentum[2], 0.5 * (0.3 + 3.0 * 4.0 / 12.0), FBT_TOL(1e-12, 1e-5)); /* with h^2 m/12 */
  desc.n_station = 2; /* the same inertia, then thrice that at the tip, which a table has next to its end */
  desc.station[1] = desc.station[0];
  desc.station[1].x = FB_R(4.0) * (FB_R(1.0) - (fb_real)FBT_TOL(9e-6, 8e-6));
  for (int taper = 0; taper < 2; taper++) {
    for (int i = 0; i < 36 && taper; i++) {
      desc.station[1].inertia[i] *= FB_R(3.0);
    }
    start();
    for (int k = 0; k < 2; k++) {
      FBT_INT_EQ(fb_exact_element_eval(&exact, &e, &state, k), FB_OK);
      FBT_NEAR_REL(e.velocity[1], 0.5 * (1.0 + 2.0 * k), FBT_TOL(1e-12, 1e-5));
      FBT_NEAR_REL(e.angular_rate[2], 0.5, FBT_TOL(1e-12, 1e-5));
      if (!taper) {
        FBT_NEAR_REL(e.momentum[1], 1.5 * (1.0 + 2.0 * k), FBT_TOL(1e-12, 5e-6));
      }
    }
  }
  desc.n_station = 1;
  input.w[2] = FB_R(0.0);
  load_tip(FB_AXES_NODE, 0.2, 0.0, 0.0);
  input.load[0].torque[2] = FB_R(0.7);
  settle();
  FBT_INT_EQ(fb_exact_element_eval(&exact, &e, &state, 0), FB_OK);
  FBT_NEAR_REL(e.moment[2], 0.7, FBT_TOL(0.05, 0.05)); /* the pull follows the tip's section */
  FBT_NEAR_REL(e.moment_strain[2], (double)e.moment[2] / 70.0, FBT_TOL(1e-12, 1e-5));
  FBT_NEAR_REL(e.force_strain[0], (double)e.force[0] / 200.0, FBT_TOL(1e-12, 1e-5));
  memset(&input, 0, sizeof input);
  load_tip(FB_AXES_INERTIAL, 0.0, 0.0, 0.5);
  start();
  state.base_quat[0] = state.base_quat[1] = FB_R(0.7071067811865476); /* y of the base is z of space */
  FBT_INT_EQ(fb_exact_trim(&exact, &state, &work, &input), FB_OK);
  FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
  FBT_NEAR_REL(node[2].displacement[1], 0.5 * (64.0 / 210.0 + 4.0 / 80.0), 0.02);
  FBT_NEAR_ABS(node[2].displacement[2], 0.0, FBT_TOL(1e-12, 1e-5));
  FBT_NEAR_REL(node[2].position[2], (double)node[2].displacement[1], FBT_TOL(1e-12, 1e-5));
}

/* E10.6, E10.13: half the work of a small load is the strain energy, also of a bent beam that is rigid in twist and
   stretch; whatever the scratch held before. */
TEST(strain_energy_is_the_work_of_the_load)
{
  const double stiffness[6] = {0.0, 0.0, 0.0, 0.0, 1.0, 2.0}, inertia[6] = {1.0, 1.0, 1.0, 0.1, 0.1, 0.1};
  const double f = FBT_TOL(1e-6, 1e-2);
  fb_energy energy;
  beam(1.0, 6, stiffness, inertia);
  desc.station[0].curvature[1] = FB_R(0.8);
  desc.n_lump = 1;
  desc.lump[0].node = 3;
  desc.lump[0].mass = FB_R(0.1);
  desc.n_station = 2; /* half as stiff at the tip */
  desc.station[1] = desc.station[0];
  desc.station[1].x = FB_R(1.0);
  for (int i = 0; i < 36; i++) {
    desc.station[1].stiffness[i] *= FB_R(0.5);
  }
  load_tip(FB_AXES_INERTIAL, 0.0, f, -2.0 * f);
  start();
  memset(&work, 0xff, sizeof work);
  FBT_INT_EQ(fb_exact_trim(&exact, &state, &work, &input), FB_OK);
  FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
  FBT_INT_EQ(fb_exact_energy_eval(&exact, &energy, &state), FB_OK);
  FBT_NEAR_REL(energy.strain, 0.5 * f * ((double)node[6].displacement[1] - 2.0 * (double)node[6].displacement[2]),
               FBT_TOL(1e-5, 1e-2));
  memset(&work, 0xff, sizeof work);
  input.w[2] = FB_R(0.5);
  FBT_INT_EQ(fb_exact_trim(&exact, &state, &work, &input), FB_OK);
  memset(&work, 0xff, sizeof work);
  FBT_INT_EQ(fb_exact_step(&exact, &state, &work, &input, FB_R(0.01)), FB_OK);
}

SUITE(exact_statics, RUN(rotations_follow_the_beam_through_whole_turns),
      RUN(rotations_next_to_a_whole_turn_are_those_of_the_attitude), RUN(turns_between_nodes_are_those_of_a_cantilever),
      RUN(elastica_is_of_order_four), RUN(linear_cantilevers_are_exact_at_the_nodes),
      RUN(tapered_rods_are_exact_at_the_nodes), RUN(rigid_beams_do_not_deflect), RUN(tapered_beams_converge_fast),
      RUN(line_loads_are_exact_at_the_nodes), RUN(points_between_nodes_lie_on_the_curve),
      RUN(points_beside_a_loaded_node_know_its_load), RUN(steady_bend_of_an_arc_matches_the_published_tip),
      RUN(steady_rotation_with_load_matches_shooting), RUN(steady_stretch_of_a_spinning_rod_is_the_closed_form),
      RUN(steady_princeton_beam_at_all_angles), RUN(steady_openfast_cantilever_hangs_as_shooting_says),
      RUN(offsets_of_a_section_are_those_of_the_forces), RUN(twist_is_that_of_the_stations),
      RUN(sections_below_zero_are_refused), RUN(curves_are_those_of_the_stations),
      RUN(loads_on_tapered_lines_are_exact_at_the_nodes), RUN(any_units_give_the_same_solution),
      RUN(supports_are_those_of_the_textbook), RUN(a_beam_slides_over_its_support), RUN(newton_converges_quadratically),
      RUN(large_turns_take_increments), RUN(the_roots_rotation_is_within_half_a_turn),
      RUN(undeformed_nodes_have_not_turned), RUN(units_are_the_beams_own), RUN(ends_are_met_to_rounding),
      RUN(dead_loads_do_not_spin_with_the_base), RUN(element_fields_have_their_units),
      RUN(strain_energy_is_the_work_of_the_load))
