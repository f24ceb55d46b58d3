/* >>exact: branches of an exact beam: the same beam as one chain, frames in closed form, crosses of booms against bodies
   with large deflection and against booms of their own, what must be constant. */
#include "exact.h"

static const double slim[6] = {0.8, 0.8, 0.8, 3e-3, 1e-3, 2e-3}, bendy[6] = {1e5, 4e4, 4e4, 80.0, 100.0, 150.0};

/* A branch at an angle about z [rad], with the joint that holds it there. */
static fb_exact_branch *branch_about_z(int at, int n, double angle)
{
  fb_exact_branch *const branch = &desc.branch[desc.n_branch++];
  branch->node = at;
  branch->n_element = n + 1;
  branch->attitude[0] = (fb_real)cos(0.5 * angle);
  branch->attitude[3] = (fb_real)sin(0.5 * angle);
  return branch;
}

static void load_node(int at, fb_axes axes, double fx, double fy, double fz)
{
  load_tip(axes, fx, fy, fz);
  input.load[input.n_load - 1].node = at;
}

/* Hub at the root, as stiff as it likes. */
static void hub(double mass, double inertia)
{
  fb_lump *const lump = &desc.lump[desc.n_lump++];
  lump->mass = (fb_real)mass;
  lump->inertia[0] = lump->inertia[1] = lump->inertia[2] = (fb_real)inertia;
}

/* ---- the same beam otherwise */

/* A beam of 8 elements from end to end, or (split) of two halves from its middle: nodes 4..0 are then 0, 6..9. */
static const int halves[9] = {9, 8, 7, 6, 0, 1, 2, 3, 4};

static void straight(int split)
{
  beam(split ? 1.5 : 3.0, split ? 4 : 8, bendy, slim);
  desc.iterations = 20;
  hub(0.3, 0.01);
  desc.lump[0].node = split ? 0 : 4;
  if (split) {
    (void)branch_about_z(0, 4, pi);
  } else {
    desc.position[0] = FB_R(-1.5);
  }
}

/* E10.26, E10.27, E10.10: the halves of a beam from its middle, held there, spinning, under gravity and loads. */
TEST(a_beam_of_two_branches_rests_as_the_chain)
{
  static fb_exact_node whole[FB_MAX_EXACT + 1];
  double most = 0.0;
  for (int split = 0; split < 2; split++) {
    straight(split);
    desc.root = split ? FB_END_CLAMPED : FB_END_FREE;
    desc.n_support = !split;
    desc.support[0].node = split ? 0 : 4;
    desc.support[0].held = split ? 0 : FB_END_CLAMPED;
    desc.gravity[2] = FB_R(-9.81);
    input.w[2] = FB_R(3.0);
    load_node(split ? halves[1] : 1, FB_AXES_BODY, 3.0, 20.0, -9.0);
    load_node(split ? halves[7] : 7, FB_AXES_INERTIAL, -2.0, 5.0, 12.0);
    settle();
    if (!split) {
      memcpy(whole, node, sizeof whole);
    }
  }
  for (int k = 0; k < 9; k++) {
    most = fmax(most, fbt_difference(whole[k].position, node[halves[k]].position, 3));
    most = fmax(most, fabs((double)whole[k].rotation[2] - (double)node[halves[k]].rotation[2]));
  }
  FBT_BELOW(0.1, fbt_largest(node[9].displacement, 3));
  FBT_BELOW(most, FBT_TOL(1e-10, 1e-4));
  fbt_figure("beam of two branches from its middle, at rest in rotation", "the same as one chain", most);
}

/* E10.26, E11.20: two torques that turn along bend and spin it in free flight; the equations of motion know no
   root. */
TEST(a_beam_of_two_branches_moves_as_the_chain)
{
  static fb_exact_node whole[FB_MAX_EXACT + 1];
  double most = 0.0, energy = 0.0;
  for (int split = 0; split < 2; split++) {
    straight(split);
    desc.root = FB_END_FREE;
    input.w[2] = FB_R(1.0);
    for (int l = 0; l < 2; l++) {
      const double about = split && l == 0 ? -1.0 : 1.0; /* its section axes are turned about z */
      load_node(split ? halves[l ? 6 : 2] : l ? 6 : 2, FB_AXES_NODE, 0.0, 0.0, 0.0);
      input.load[l].torque[0] = (fb_real)(about * (l ? 8.0 : -3.0));
      input.load[l].torque[1] = (fb_real)(about * (l ? 20.0 : 30.0));
      input.load[l].torque[2] = (fb_real)(l ? -25.0 : 40.0);
    }
    start();
    if (steps(FBT_TOL(100, 25), 4e-3) != FB_OK) {
      return;
    }
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    if (!split) {
      memcpy(whole, node, sizeof whole);
      energy = total_energy();
    }
  }
  for (int k = 0; k < 9; k++) {
    const fb_exact_node *const a = &whole[k], *const b = &node[halves[k]];
    const double turned = k < 4 ? -1.0 : 1.0;
    most = fmax(most, fabs((double)a->angular_rate[0] - turned * (double)b->angular_rate[0]));
    most = fmax(most, fabs((double)a->angular_rate[1] - turned * (double)b->angular_rate[1]));
    most = fmax(most, fabs((double)a->angular_rate[2] - (double)b->angular_rate[2]));
  }
  most /= fbt_largest(node[9].angular_rate, 3);
  FBT_BELOW(most, FBT_TOL(1e-9, 1e-2));
  FBT_NEAR_REL(total_energy(), energy,
               FBT_TOL(1e-6, 1e-3)); /* of the frame's velocity by the poses: order of the step */
  fbt_figure("beam of two branches from its middle in free flight, rates", "the same as one chain", most);
}

/* E10.26: a branch at the tip of the chain, without an attitude, is the chain, in other units. */
TEST(a_branch_at_the_tip_is_the_chain)
{
  fb_real tip[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)};
  for (int split = 0; split < 2; split++) {
    beam(split ? 1.5 : 3.0, split ? 4 : 8, bendy, slim);
    desc.n_branch = split;
    desc.branch[0].node = desc.branch[0].n_element = 4 * split;
    desc.gravity[2] = FB_R(-9.81);
    load_node(8, FB_AXES_INERTIAL, 0.0, 30.0, 0.0);
    start();
    FBT_INT_EQ(exact.n_branch, 0);
    if (steps(20, 1e-2) != FB_OK) {
      return;
    }
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    if (!split) {
      memcpy(tip, node[8].position, sizeof tip);
    }
  }
  FBT_BELOW(0.05, fbt_largest(node[8].displacement, 3));
  FBT_BELOW(fbt_difference(tip, node[8].position, 3), FBT_TOL(1e-12, 1e-4));
}

/* ---- at an angle */

/* E10.27: a boom with twisted sections at any angle on a held node is the boom with that attitude: where it stands,
   rests and moves. */
TEST(branches_stand_at_their_angle_and_twist)
{
  static fb_exact_node alone[2][FB_MAX_EXACT + 1];
  double stand = 0.0, most = 0.0;
  for (int on = 0; on < 2; on++) {
    const fb_real attitude[4] = {FB_R(0.5), FB_R(-0.3), FB_R(0.7), FB_R(0.2)};
    const int n = 6, first = on ? 3 : 0; /* its node k is first + k */
    beam(on ? 0.7 : 2.0, on ? 2 : n, bendy, slim);
    for (int k = 1; k < 4; k++) { /* two stations of its own */
      desc.station[k] = desc.station[0];
    }
    desc.station[on].twist = FB_R(0.4);
    desc.station[on + 1].twist = FB_R(-0.8);
    desc.station[on + 1].x = FB_R(2.0);
    desc.station[on + 1].stiffness[35] *= FB_R(0.5);
    desc.n_station = on ? 1 : 2;
    memcpy(on ? desc.branch[0].attitude : desc.attitude, attitude, sizeof attitude);
    if (on) {
      desc.n_branch = 1;
      desc.branch[0].n_element = n + 1;
      desc.branch[0].station = 1;
      desc.branch[0].n_station = 2;
      desc.branch[0].length = FB_R(2.0);
    }
    desc.gravity[2] = FB_R(-9.81);
    input.w[1] = FB_R(2.0);
    load_node(first + n, FB_AXES_NODE, 3.0, 8.0, -9.0);
    start();
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    for (int k = 0; k <= n && on; k++) {
      stand = fmax(stand, fbt_difference(alone[0][k].position, node[k ? first + k : 0].position, 3));
      stand = fmax(stand, k ? fbt_difference(alone[0][k].quat, node[first + k].quat, 4) : 0.0);
    }
    memcpy(alone[0], node, sizeof node);
    settle();
    for (int k = 1; k <= n && on; k++) {
      most = fmax(most, fbt_difference(alone[1][k].position, node[first + k].position, 3));
      most = fmax(most, fbt_difference(alone[1][k].rotation, node[first + k].rotation, 3));
    }
    memcpy(alone[1], node, sizeof node);
  }
  FBT_BELOW(stand, FBT_TOL(1e-14, 1e-6));
  FBT_BELOW(0.02, fbt_largest(node[9].displacement, 3));
  FBT_BELOW(most, FBT_TOL(1e-11, 1e-4));
}

/* fb_exact_point_eval, E10.12: lines follow each other; points of a branch lie where those of the boom alone do. */
TEST(points_lie_on_their_branch)
{
  fb_real alone[5][3], r[3], quat[4];
  for (int on = 0; on < 2; on++) {
    beam(on ? 0.7 : 2.0, on ? 2 : 5, bendy, slim);
    if (on) {
      branch_about_z(0, 5, 0.5 * pi)->length = FB_R(2.0);
    } else {
      desc.attitude[0] = desc.attitude[3] = FB_R(0.5);
    }
    input.line[2].force[0] = on ? FB_R(0.0) : FB_R(90.0);
    input.line[5].force[0] = on ? FB_R(90.0) : FB_R(0.0);
    load_node(on ? 8 : 5, FB_AXES_INERTIAL, 40.0, 0.0, 10.0);
    settle();
    for (int k = 0; k < 5; k++) {
      const double x = (on ? 0.7 : 0.0) + 0.1 + 0.45 * k;
      FBT_INT_EQ(fb_exact_point_eval(&exact, r, quat, &state, (fb_real)x), FB_OK);
      if (on) {
        FBT_BELOW(fbt_difference(alone[k], r, 3), FBT_TOL(1e-10, 1e-4));
      } else {
        memcpy(alone[k], r, sizeof r);
      }
    }
  }
  FBT_INT_EQ(fb_exact_point_eval(&exact, r, quat, &state, FB_R(2.71)), FB_ERR_VALUE);
}

/* ---- a T-shaped frame: column along x, clamped, arms at its tip along +-y */

static const double frame_length = 2.0, frame_arm = 1.2, frame_EI = 50.0, frame_mass = 0.7;

static void frame(int n)
{
  const double stiffness[6] = {0.0, 0.0, 0.0, 0.0, 0.0, frame_EI}, inertia[6] = {frame_mass, frame_mass, frame_mass};
  beam(frame_length, n, stiffness, inertia);
  for (int side = -1; side <= 1; side += 2) {
    branch_about_z(n, n, side * 0.5 * pi)->length = (fb_real)frame_arm;
  }
}

/* E10.26: a force at the tip of an arm, across it: F a^3/3EI of the arm and F a L/EI of the column's tip, which moves by
   F a L^2/2EI; the other arm turns along. Its energy is half the work. */
TEST(frames_bend_in_closed_form)
{
  const double F = FBT_TOL(1e-6, 1e-2), a = frame_arm, L = frame_length, turn = F * a * L / frame_EI;
  const int n = 4, left = 3 * n + 2, right = 2 * n + 1;
  frame(n);
  load_node(left, FB_AXES_BODY, F, 0.0, 0.0); /* on +y: turns by -F a about z */
  settle();
  FBT_NEAR_REL(node[left].displacement[0], F * a * a * a / (3.0 * frame_EI) + turn * a, FBT_TOL(1e-7, 3e-3));
  FBT_NEAR_REL(node[n].displacement[1], -0.5 * turn * L, FBT_TOL(1e-7, 3e-3));
  FBT_NEAR_REL(node[n].rotation[2], -turn, FBT_TOL(1e-7, 3e-3));
  FBT_NEAR_REL(node[right].displacement[0], -turn * a, FBT_TOL(1e-6, 1e-2));
  FBT_NEAR_REL(total_energy(), 0.5 * F * (double)node[left].displacement[0], FBT_TOL(1e-6, 1e-2));
  FBT_INT_EQ(work.unstable, 0);
  FBT_NEAR_REL(node[0].moment[2], -F * a, FBT_TOL(1e-6, 1e-3));
  FBT_NEAR_REL(node[n].moment[2], -F * a, FBT_TOL(1e-6, 1e-3));
}

/* Moment at the root of an arm by its turn, pinned there, its tip free; force and moment at the tip of the column by its
   motion: of Euler-Bernoulli beams at the angular frequency w, order of the determinant of both. */
static double frame_determinant(double w)
{
  const double k = pow(frame_mass * w * w / frame_EI, 0.25), a = k * frame_arm, l = k * frame_length;
  const double sa = sin(a), ca = cos(a), SA = sinh(a), CA = cosh(a), s = sin(l), c = cos(l), S = sinh(l), C = cosh(l);
  const double arm = frame_EI * k * (CA * sa - SA * ca) / (1.0 + ca * CA);
  const double column = frame_EI / (1.0 - c * C);
  const double shear = column * k * k * k * (C * s + S * c), moment = column * k * (C * s - S * c);
  const double cross = -column * k * k * s * S, mass = 2.0 * frame_mass * frame_arm * w * w;
  return (shear - mass) * (moment - 2.0 * arm) - cross * cross;
}

/* E10.26, E12.4: natural frequencies of the frame; arms to and fro as cantilevers, the rest by its determinant, all of
   order 4 in the elements. */
TEST(frames_swing_as_euler_and_bernoulli_say)
{
  const double cantilever = 3.516015268500 / (frame_arm * frame_arm) * sqrt(frame_EI / frame_mass);
  double most[2] = {0.0, 0.0};
  for (int fine = 0; fine < (FB_SINGLE ? 1 : 2); fine++) {
    int swings = 0;
    frame(fine ? 12 : 6);
    settle();
    spectrum_of(4);
    for (int k = 0; k < 4; k++) {
      const double w = (double)spectrum.im[k], h = 1e-5 * w, off = fabs(w / cantilever - 1.0);
      const double slope = (frame_determinant(w + h) - frame_determinant(w - h)) / (2.0 * h);
      const int swing = off < 1e-3;
      swings += swing;
      most[fine] = fmax(most[fine], swing ? off : fabs(frame_determinant(w) / (slope * w)));
      FBT_NEAR_ABS(spectrum.re[k], 0.0, FBT_TOL(1e-5, 1e-2) * w);
    }
    FBT_INT_EQ(swings, 1);
  }
  FBT_BELOW(most[0], 5e-3);
  if (!FB_SINGLE) {
    FBT_NEAR_ABS(log2(most[0] / most[1]), 4.0, 0.3);
    fbt_figure("first four natural frequencies of a T-shaped frame, 12 elements a member", "Euler-Bernoulli frame",
               most[1]);
  }
}

/* ---- crosses of booms */

static void cross_of(int booms, int n)
{
  beam(2.0, n, bendy, slim);
  for (int b = 1; b < booms; b++) {
    (void)branch_about_z(0, n, 2.0 * pi * b / booms);
  }
  hub(5.0, 2.0);
}

/* E10.13, E10.14, E10.26: four booms on a free hub, spun up by a torque on it, then left: energy is constant, tips stay
   as they are to each other, the mass center where it was. */
TEST(a_cross_spins_up_and_keeps_energy)
{
  const int n = 5, tip[4] = {5, 11, 17, 23};
  double before, worst = 0.0, apart = 0.0, turned;
  fb_momentum first, last;
  cross_of(4, n);
  desc.root = FB_END_FREE;
  desc.iterations = 12;
  load_node(0, FB_AXES_NODE, 0.0, 0.0, 0.0);
  input.load[0].torque[2] = FB_R(150.0);
  start();
  if (steps(200, 2e-3) != FB_OK) {
    return;
  }
  FBT_INT_EQ(fb_exact_momentum_eval(&exact, &first, &state), FB_OK);
  FBT_NEAR_REL(first.angular[2], 150.0 * 0.4, FBT_TOL(3e-3, 1e-2));
  input.n_load = 0;
  before = total_energy();
  for (int k = 0; k < FBT_LONG(10, 4); k++) {
    if (steps(100, 2e-3) != FB_OK) {
      return;
    }
    worst = fmax(worst, fabs(total_energy() / before - 1.0));
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    for (int b = 0; b < 4; b++) {
      const double c = cos(0.5 * pi * b), s = sin(0.5 * pi * b);
      const fb_real *const a = node[tip[0]].displacement, *const d = node[tip[b]].displacement;
      apart = fmax(apart, fabs(c * (double)a[0] - s * (double)a[1] - (double)d[0]));
      apart = fmax(apart, fabs(s * (double)a[0] + c * (double)a[1] - (double)d[1]));
    }
  }
  turned = fbt_largest(node[tip[0]].displacement, 3);
  FBT_INT_EQ(fb_exact_momentum_eval(&exact, &last, &state), FB_OK);
  FBT_BELOW(0.02, turned);
  FBT_BELOW(worst, FBT_TOL(1e-11, 1e-3));
  FBT_BELOW(apart, FBT_TOL(1e-11, 1e-3));
  FBT_BELOW(fbt_largest(last.linear, 3), FBT_TOL(1e-10, 1e-3));
  FBT_BELOW(fabs((double)last.angular[2] / (double)first.angular[2] - 1.0), FBT_TOL(1e-3, 1e-2));
  fbt_figure("energy of a cross of four booms spun up, over 1000 steps, relative", "constant", worst);
  fbt_figure("tips of that cross against each other [m]", "symmetry", apart);
}

/* E12.4, E10.11: steady rotation and modes of two booms on a hub that is held: those of each boom, twice. */
TEST(booms_on_a_spinning_hub_have_the_modes_of_one)
{
  double alone[3], most = 0.0;
  for (int booms = 1; booms <= 2; booms++) {
    cross_of(booms, 6);
    input.w[2] = FB_R(4.0);
    settle();
    spectrum_of(booms * 3);
    for (int k = 0; k < booms * 3; k++) {
      if (booms == 1) {
        alone[k] = (double)spectrum.im[k];
      } else {
        most = fmax(most, fabs((double)spectrum.im[k] / alone[k / 2] - 1.0));
      }
    }
  }
  FBT_BELOW(most, FBT_TOL(1e-8, 1e-3));
}

/* ---- two booms at a right angle on a free hub, pushed at one tip by half its length: the body of two lines */

#if FB_WITH_LARGE_DEFLECTION
enum { PUSH_SAMPLES = 20 }; /* of 0.05 s */

static void push(fb_load *load, int at, double t)
{
  const double s = sin(pi * t) * sin(pi * t);
  memset(load, 0, sizeof *load);
  load->node = at;
  load->axes = FB_AXES_BODY;
  load->force[1] = (fb_real)(12.0 * s);
  load->force[2] = (fb_real)(7.0 * s);
}

/* Tips of both booms, 1 along x and 2 along y, of the exact beam. */
static void push_exact(double tip[PUSH_SAMPLES][6], const fb_section *section, int n, int steps_of_sample)
{
  const double dt = 0.05 / steps_of_sample;
  fb_status status = FB_OK;
  memset(&desc, 0, sizeof desc);
  memset(&input, 0, sizeof input);
  desc.length = FB_R(2.0);
  desc.n_element = n;
  desc.n_station = 1;
  FBT_INT_EQ(fb_exact_station_init(&desc.station[0], section), FB_OK);
  (void)branch_about_z(0, n, 0.5 * pi);
  hub(10.0, 5.0);
  desc.root = FB_END_FREE;
  start();
  input.n_load = 1;
  for (int k = 0; k < PUSH_SAMPLES; k++) {
    for (int i = 0; i < steps_of_sample && status == FB_OK; i++) {
      push(&input.load[0], n, (k * steps_of_sample + i + 0.5) * dt);
      status = fb_exact_step(&exact, &state, &work, &input, (fb_real)dt);
    }
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    for (int i = 0; i < 6; i++) {
      tip[k][i] = (double)node[i < 3 ? n : 2 * n + 1].position[i % 3];
    }
  }
  FBT_INT_EQ(status, FB_OK);
}

/* The body: nodes 1 and 2 are its tips. */
static void push_body(fb_body *body, const fb_section *section)
{
  static fb_beam_desc beam_desc;
  static fb_beam boom;
  static fb_modes_desc keep;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_shape shape;
  static fb_body_desc level;
  static fb_body_work body_work;
  const fb_real center[3] = {FB_R(0.0)}, inertia[6] = {FB_R(5.0), FB_R(5.0), FB_R(5.0)};
  memset(&beam_desc, 0, sizeof beam_desc);
  memset(&keep, 0, sizeof keep);
  memset(&level, 0, sizeof level);
  beam_desc.length = FB_R(2.0);
  beam_desc.n_element = 8;
  beam_desc.n_station = 1;
  beam_desc.station[0] = *section;
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 3;
  keep.count[FB_KIND_TORSION] = 3;
  keep.line_points = 14;
  for (int axis = 1; axis < 4; axis++) {
    keep.load[keep.n_load].node = 8;
    keep.load[keep.n_load++].axis = axis;
  }
  level.effects = FB_EFFECTS_LARGE;
  level.allow_long_step = 1;
  level.deflection_limit = FB_R(100.0);
  for (int b = 0; b < 2; b++) {
    int at;
    beam_desc.attitude[0] = b ? FB_R(0.70710678118654752) : FB_R(1.0);
    beam_desc.attitude[3] = b ? FB_R(0.70710678118654752) : FB_R(0.0);
    FBT_INT_EQ(fb_beam_init(&boom, &beam_desc), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &boom, &keep), FB_OK);
    if (b == 0) {
      FBT_INT_EQ(fb_shape_init(&shape, 2 * modes.n), FB_OK);
      FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(10.0), center, inertia), FB_OK);
    }
    FBT_INT_EQ(fb_shape_add_beam(&shape, b * modes.n, &boom, &modes), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &at, b * modes.n, &boom, &modes, FB_R(2.0)), FB_OK);
  }
  FBT_INT_EQ(fb_body_init(body, &body_work, &shape, &level), FB_OK);
}

/* E10.26: extrapolated in the step. */
TEST(booms_on_a_free_hub_move_as_a_body_of_two_lines)
{
  static double tip[2][PUSH_SAMPLES][6];
  static fb_body body;
  static fb_rk4_work rk4;
  fb_section section;
  const int steps_of_body = 60;
  const double dt = 0.05 / steps_of_body;
  double most = 0.0, size = 0.0;
  fb_state moving;
  fb_input in[3];
  fb_status status = FB_OK;
  memset(&section, 0, sizeof section);
  section.mass = FB_R(0.4);
  section.GJ = FB_R(20.0);
  section.EI_y = FB_R(40.0);
  section.EI_z = FB_R(60.0);
  section.i_y = section.i_z = FB_R(0.001);
  push_exact(tip[0], &section, 16, FBT_TOL(12, 3));
  push_exact(tip[1], &section, 16, FBT_TOL(24, 6));
  push_body(&body, &section);
  FBT_INT_EQ(fb_state_init(&body, &moving), FB_OK);
  memset(in, 0, sizeof in);
  in[0].n_load = in[1].n_load = in[2].n_load = 1;
  for (int k = 0; k < PUSH_SAMPLES && status == FB_OK; k++) {
    fb_motion motion;
    for (int i = 0; i < steps_of_body && status == FB_OK; i++) {
      for (int stage = 0; stage < 3; stage++) {
        push(&in[stage].load[0], 1, (k * steps_of_body + i + 0.5 * stage) * dt);
      }
      status = fb_rk4_step(&body, &moving, &rk4, &in[0], &in[1], &in[2], (fb_real)dt);
    }
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &moving, NULL), FB_OK);
    for (int b = 0; b < 2; b++) {
      fb_node_motion at;
      FBT_INT_EQ(fb_body_node_motion_eval(&body, &at, &moving, &motion, b + 1), FB_OK);
      for (int i = 0; i < 3; i++) {
        const double x = tip[1][k][3 * b + i] + (tip[1][k][3 * b + i] - tip[0][k][3 * b + i]) / 3.0;
        most = fmax(most, fabs((double)at.position[i] - x));
        size = fmax(size, fabs(x - (i == b ? 2.0 : 0.0)));
      }
    }
  }
  FBT_INT_EQ(status, FB_OK);
  FBT_BELOW(0.8, size);
  FBT_BELOW(most / size, FBT_TOL(1e-3, 1e-2));
  fbt_figure("two booms on a free hub, one pushed by half its length", "body of two lines, 3 + 3 + 3 modes and loads",
             most / size);
}
#define RUN_LARGE RUN(booms_on_a_free_hub_move_as_a_body_of_two_lines),
#else
#define RUN_LARGE
#endif

/* ---- joints on branches, paths, linear models */

/* Three blades with flap hinges on a spinning hub; the second flaps at the start. */
static void blades(int n, int root)
{
  beam(2.0, n + 1, bendy, slim);
  desc.iterations = 12;
  desc.root = root;
  hub(5.0, 2.0);
  for (int b = 0; b < 3; b++) {
    fb_exact_joint *const joint = &desc.joint[desc.n_joint++];
    joint->element = b ? (n + 1) + (n + 2) * (b - 1) + 1 : 0;
    joint->axis[1] = FB_R(1.0);
    joint->rate = b == 1 ? FB_R(-1.5) : FB_R(0.0);
    if (b) {
      (void)branch_about_z(0, n + 1, 2.0 * pi * b / 3.0);
    }
  }
  input.w[2] = FB_R(5.0);
  start();
}

/* E10.25, E10.26, E11.20: on a hub that is held the other blades do not flap; on a free one energy is kept but for what
   the momentum of a beam in flight drifts by (E11.33: of one such blade alone 1.4e-7). */
TEST(hinged_blades_flap_one_by_one)
{
  const int n = 3;
  double before, worst = 0.0;
  blades(n, FB_END_CLAMPED);
  FBT_INT_EQ(exact.n_joint, 5);
  FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
  for (int k = 0; k <= exact.n; k++) {
    const int flaps = k > n + 2 && k <= 2 * n + 3;
    const double reach = sqrt(pow((double)node[k].position[0], 2.0) + pow((double)node[k].position[1], 2.0));
    FBT_NEAR_ABS(node[k].velocity[2], flaps ? 1.5 * reach : 0.0, FBT_TOL(1e-12, 1e-5));
  }
  (void)steps(200, 2e-3);
  FBT_BELOW(0.1, fabs((double)state.angle[1]));
  FBT_BELOW(fabs((double)state.angle[0]) + fabs((double)state.angle[2]), FBT_TOL(1e-12, 1e-4));

  blades(n, FB_END_FREE);
  before = total_energy();
  for (int k = 0; k < 20; k++) {
    if (steps(20, 2e-3) != FB_OK) {
      return;
    }
    worst = fmax(worst, fabs(total_energy() / before - 1.0));
  }
  FBT_BELOW(0.1, fabs((double)state.angle[1]));
  FBT_BELOW(worst, FBT_TOL(1e-7, 1e-3));
  fbt_figure("energy of three hinged blades on a free hub, relative", "constant", worst);
}

/* E12.13 to E12.17: on a frame, the static gain of a linear model and the path of steady states are those of
   fb_exact_trim. */
TEST(linear_models_and_paths_know_branches)
{
  static fb_exact_linear_work linear_work;
  static fb_exact_linear linear;
  static fb_exact_path_work path_work;
  static fb_exact_path path;
  static fb_exact_state bent;
  fb_linear_desc ports;
  const int n = 3, left = 3 * n + 2;
  double more, gain, rest[FB_EXACT_STATES];
  frame(n);
  for (int i = 0; i < 6; i++) { /* not rigid */
    desc.station[0].stiffness[7 * i] = (fb_real)bendy[i];
    desc.station[0].inertia[7 * i] = (fb_real)slim[i];
  }
  load_node(left, FB_AXES_BODY, 30.0, 0.0, 12.0);
  settle();

  /* Gain of the force on the displacement of the other tip */
  memset(&ports, 0, sizeof ports);
  ports.n_in = ports.n_out = 1;
  ports.in[0].kind = FB_PORT_FORCE;
  ports.in[0].node = left;
  ports.in[0].axes = FB_AXES_BODY;
  ports.out[0].kind = FB_PORT_DISPLACEMENT;
  ports.out[0].node = 2 * n + 1;
  FBT_INT_EQ(fb_exact_linearize(&exact, &linear_work, &linear, &state, &input, &ports, 3), FB_OK);
  gain = (double)linear.D[0];
  for (int k = 0; k < linear.n; k += 2) { /* -C A^-1 B of its pairs */
    const double a = (double)linear.A[k * linear.n + k], b = (double)linear.A[k * linear.n + k + 1];
    const double c = (double)linear.A[(k + 1) * linear.n + k], e = (double)linear.A[(k + 1) * linear.n + k + 1];
    rest[k] = (e * (double)linear.B[k] - b * (double)linear.B[k + 1]) / (a * e - b * c);
    rest[k + 1] = (a * (double)linear.B[k + 1] - c * (double)linear.B[k]) / (a * e - b * c);
    gain -= (double)linear.C[k] * rest[k] + (double)linear.C[k + 1] * rest[k + 1];
  }
  more = FBT_TOL(1e-4, 0.3);
  input.load[0].force[0] = (fb_real)(30.0 + more);
  settle();
  gain *= 2.0 * more;
  gain -= (double)node[2 * n + 1].displacement[0];
  input.load[0].force[0] = (fb_real)(30.0 - more);
  settle();
  gain += (double)node[2 * n + 1].displacement[0];
  FBT_NEAR_ABS(gain / (2.0 * more), 0.0, FBT_TOL(1e-7, 1e-3));

  /* Along a path from nothing */
  input.load[0].force[0] = FB_R(0.0);
  input.load[0].force[2] = FB_R(0.0);
  settle();
  memset(&path, 0, sizeof path);
  input.load[0].force[0] = FB_R(30.0);
  input.load[0].force[2] = FB_R(12.0);
  for (int k = 0; k < 3; k++) {
    FBT_INT_EQ(fb_exact_path_step(&exact, &path, &state, &path_work, NULL, &input, FB_R(0.3)), FB_OK);
  }
  bent = state;
  input.load[0].force[0] *= path.factor;
  input.load[0].force[2] *= path.factor;
  settle();
  FBT_BELOW(0.3, path.factor);
  FBT_BELOW(fbt_difference(bent.r, state.r, 3 * (exact.n + 1)), FBT_TOL(1e-8, 1e-3));
}

/* ---- what cannot be */

/* Interface: every field of a branch out of range is refused by its name. */
TEST(branches_that_cannot_be_are_refused)
{
  static const char *const word[] = {"node",       "elements", "all of them", "n_station", "station",
                                     "length",     "infinite", "attitude",    "joint",     "held",
                                     "all joints", "place",    "x",           "n_branch"};
  for (int bad = 0; bad < FBT_COUNT(word); bad++) {
    fb_exact_branch *branch;
    beam(1.0, 4, bendy, slim);
    branch = branch_about_z(2, 3, 0.5 * pi);
    branch->node = bad == 0 ? 5 : 2;
    branch->n_element = bad == 1 ? 0 : bad == 2 ? FB_MAX_EXACT - 3 : bad == 10 ? 1 : 4;
    branch->n_station = bad == 3 ? -1 : bad == 4 ? 1 : bad == 12 ? 2 : 0;
    branch->station = bad == 4 ? FB_MAX_STATIONS : 0;
    desc.station[1] = desc.station[0];
    desc.station[1].x = FB_R(0.8);
    branch->length = bad == 5 ? FB_R(-1.0) : bad == 6 ? (fb_real)INFINITY : FB_R(0.0);
    branch->attitude[1] = bad == 7 ? (fb_real)NAN : FB_R(0.0);
    desc.n_joint = bad == 8;
    desc.joint[0].element = bad == 8 ? 4 : 0;
    desc.joint[0].axis[0] = bad == 8 ? FB_R(1.0) : FB_R(0.0);
    desc.n_support = bad == 9;
    desc.support[0].node = bad == 9 ? 5 : 0;
    desc.support[0].held = bad == 9 ? FB_END_PINNED : 0;
    desc.place[6] = bad == 11 ? FB_R(-0.5) : FB_R(0.0);
    desc.n_branch = bad == 13 ? FB_MAX_LUMPS + 1 : 1;
    FBT_INT_EQ(fb_exact_init(&exact, &desc), bad < 5 || bad == 13   ? FB_ERR_CAPACITY
                                             : bad == 6 || bad == 7 ? FB_ERR_NOT_FINITE
                                                                    : FB_ERR_VALUE);
  }

  /* Models: a list of branches that does not fit, an element that hangs on a later node */
  for (int bad = 0; bad < 5; bad++) {
    beam(1.0, 4, bendy, slim);
    (void)branch_about_z(2, 3, 0.5 * pi);
    start();
    exact.n_branch = bad == 0 ? 0 : bad == 1 ? FB_MAX_LUMPS + 1 : 1;
    exact.branch[0] = bad == 2 ? 3 : 4;
    exact.inboard[2] = bad == 3 ? 3 : bad == 4 ? 1 : 2;
    FBT_INT_EQ(fb_exact_check(&exact), bad == 1 ? FB_ERR_CAPACITY : FB_ERR_VALUE);
  }
}

/* E10.26, E10.3: a beam that a moment of its tip bends by M L/EI = 8 rad turns its branch with the node that carries it,
   not with the tip, whose number comes before. */
TEST(branches_turn_with_their_node)
{
  elastica(8);
  (void)branch_about_z(2, 2, 0.5 * pi);
  load_tip(FB_AXES_BODY, 0.0, 0.0, 0.0);
  input.load[0].torque[2] = FB_R(8.0);
  desc.iterations = 20;
  settle();
  FBT_NEAR_REL(node[8].rotation[2], 8.0, FBT_TOL(1e-9, 1e-3));
  for (int k = 9; k <= exact.n; k++) {
    FBT_NEAR_REL(node[k].rotation[2], 2.0, FBT_TOL(1e-9, 1e-3));
  }
}

SUITE(exact_branches, RUN(branches_turn_with_their_node), RUN(a_beam_of_two_branches_rests_as_the_chain),
      RUN(a_beam_of_two_branches_moves_as_the_chain), RUN(a_branch_at_the_tip_is_the_chain),
      RUN(branches_stand_at_their_angle_and_twist), RUN(points_lie_on_their_branch), RUN(frames_bend_in_closed_form),
      RUN(frames_swing_as_euler_and_bernoulli_say), RUN(a_cross_spins_up_and_keeps_energy),
      RUN(booms_on_a_spinning_hub_have_the_modes_of_one), RUN_LARGE RUN(hinged_blades_flap_one_by_one),
      RUN(linear_models_and_paths_know_branches), RUN(branches_that_cannot_be_are_refused))
