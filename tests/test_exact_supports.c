/* test_exact_supports.c - supports of the geometrically exact beam that are moved: elastic and inextensible catenaries,
   bends and twists in closed form, the same motion by the base, work, modal sums, taut strings. */
#include "exact.h"

static fb_support_place *move_support(int at)
{
  fb_support_place *const place = &input.support[input.n_support++];
  place->node = at;
  return place;
}

/* ---- steady states */

/* Irvine's elastic catenary of weight w per unstrained length, from its lower end on: forces H, V at the begin with which it
   ends at x, z, by Newton's method. compliance 1/EA. */
static void catenary_point(double *x, double *z, double H, double V, double w, double compliance, double s)
{
  const double a = V / H, b = (V + w * s) / H;
  *x = H * s * compliance + H / w * (asinh(b) - asinh(a));
  *z = s * (V + 0.5 * w * s) * compliance + H / w * (sqrt(1.0 + b * b) - sqrt(1.0 + a * a));
}

static void catenary_forces(double *H, double *V, double w, double compliance, double length, double x, double z)
{
  for (int k = 0; k < 60; k++) {
    double f[3][2], J[4], d[2];
    catenary_point(&f[0][0], &f[0][1], *H, *V, w, compliance, length);
    catenary_point(&f[1][0], &f[1][1], *H * (1.0 + 1e-6), *V, w, compliance, length);
    catenary_point(&f[2][0], &f[2][1], *H, *V + 1e-6 * w * length, w, compliance, length);
    for (int i = 0; i < 2; i++) {
      J[2 * i] = (f[1][i] - f[0][i]) / (1e-6 * *H);
      J[2 * i + 1] = (f[2][i] - f[0][i]) / (1e-6 * w * length);
    }
    d[0] = (J[3] * (x - f[0][0]) - J[1] * (z - f[0][1])) / (J[0] * J[3] - J[1] * J[2]);
    d[1] = (J[0] * (z - f[0][1]) - J[2] * (x - f[0][0])) / (J[0] * J[3] - J[1] * J[2]);
    *H *= fmax(0.5, fmin(2.0, 1.0 + d[0] / *H));
    *V += d[1];
  }
}

/* E10.11, E10.30: a line that is straight without load and held by hinges, its far end moved in, up or down, hangs as
   Irvine's elastic catenary (Cable Structures, 1981), one of 1e-5 stretch under its weight as the catenary: but for its
   bending, whose part is as large as EI, and of which two lines know what is without. */
TEST(slack_lines_hang_as_catenaries)
{
  static const double compliance[3] = {1e-5, 0.05, 0.002}, end[3][2] = {{0.7, 0.0}, {0.8, 0.3}, {0.6, -0.4}};
  for (int run = 0; run < 3; run++) {
    double H = 0.3, V = -0.5, pull[2], place[2][41][2];
    catenary_forces(&H, &V, 1.0, compliance[run], 1.0, end[run][0], end[run][1]);
    for (int thin = 0; thin < 2; thin++) {
      const double EI = thin ? 1e-4 : 2e-4, stiffness[6] = {1.0 / compliance[run], 0.0, 0.0, 1e-3, EI, EI};
      const double inertia[6] = {1.0, 1.0, 1.0, 0.0, 0.0, 0.0};
      fb_support_place *tip;
      beam(1.0, 40, stiffness, inertia);
      desc.root = FB_END_PINNED | FB_HOLD_RX;
      desc.tip = FB_END_PINNED;
      desc.gravity[2] = -FB_R(1.0);
      desc.position[0] = FB_R(0.5);
      tip = move_support(40);
      tip->displacement[0] = (fb_real)(end[run][0] - 1.0);
      tip->displacement[2] = (fb_real)end[run][1];
      settle();
      FBT_INT_EQ(work.unstable, 0);
      pull[thin] = distance(node[40].reaction_force, 0.0, 0.0, 0.0);
      for (int k = 0; k <= 40; k++) {
        place[thin][k][0] = (double)node[k].position[0] - 0.5;
        place[thin][k][1] = (double)node[k].position[2];
      }
    }
    FBT_NEAR_REL(2.0 * pull[1] - pull[0], sqrt(H * H + (V + 1.0) * (V + 1.0)), FBT_TOL(1e-3, 1e-3));
    for (int k = 0; k <= 40; k += 5) {
      double x[2];
      catenary_point(&x[0], &x[1], H, V, 1.0, compliance[run], 0.025 * k);
      for (int i = 0; i < 2; i++) {
        FBT_NEAR_ABS(2.0 * place[1][k][i] - place[0][k][i], x[i], FBT_TOL(6e-5, 6e-5));
      }
    }
  }
}

/* E10.30: the support amid a beam on three that settles by d is loaded by d/(L^3/(48 EI) + L/(4 GA)); a tip that is brought to the end of
   a quarter of a circle and turned with it is loaded by EI (pi/2)/L alone; one that is turned about its line by GJ phi/L. */
TEST(settled_and_turned_supports_pull_as_in_closed_form)
{
  const double stiffness[6] = {1e6, 1e6, 1e6, 70.0, 100.0, 100.0}, r = 4.0 / pi;
  fb_support_place *place;
  beam(2.0, 20, stiffness, NULL);
  desc.root = FB_END_PINNED | FB_HOLD_RX;
  desc.tip = FB_HOLD_Y | FB_HOLD_Z;
  desc.n_support = 1;
  desc.support[0].node = 10;
  desc.support[0].held = FB_HOLD_Z;
  move_support(10)->displacement[2] = FB_R(2e-3);
  settle();
  FBT_NEAR_REL(node[10].reaction_force[2], 2e-3 / (8.0 / (48.0 * 100.0) + 2.0 / (4.0 * 1e6)), FBT_TOL(1e-5, 1e-3));
  FBT_NEAR_REL(node[10].displacement[2], 2e-3, FBT_TOL(1e-9, 1e-4));

  for (int hinged = 1; hinged >= 0; hinged--) { /* about its line */
    beam(2.0, 20, stiffness, NULL);
    desc.tip = hinged ? FB_END_CLAMPED & ~FB_HOLD_RX : FB_END_CLAMPED;
    settle();
    place = move_support(20);
    for (int k = 1; k <= 8; k++) { /* on the way of arcs: straight there it would buckle */
      const double angle = 0.0625 * pi * k;
      place->displacement[0] = (fb_real)(2.0 * sin(angle) / angle - 2.0);
      place->displacement[1] = (fb_real)(2.0 * (1.0 - cos(angle)) / angle);
      place->rotation[2] = (fb_real)angle;
      FBT_INT_EQ(fb_exact_trim(&exact, &state, &work, &input), FB_OK);
    }
    FBT_INT_EQ(work.unstable, 0);
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    FBT_NEAR_REL(node[20].reaction_moment[2], 25.0 * pi, FBT_TOL(1e-6, 1e-3));
    FBT_ZERO(fbt_largest(node[20].reaction_force, 3), 100.0, FBT_TOL(1e-6, 1e-2));
    FBT_NEAR_ABS(distance(node[10].position, r * sin(0.25 * pi), r * (1.0 - cos(0.25 * pi)), 0.0), 0.0,
                 FBT_TOL(1e-6, 1e-4));
  }

  for (int turns = 0; turns < 3; turns++) { /* whole ones count */
    const double angle = 2.5 + 2.0 * pi * turns;
    input.n_support = 0;
    memset(input.support, 0, sizeof input.support);
    move_support(20)->rotation[0] = (fb_real)angle;
    settle();
    FBT_NEAR_REL(node[20].reaction_moment[0], 35.0 * angle, FBT_TOL(1e-6, 1e-3));
  }
  FBT_INT_EQ(fb_exact_trim(&exact, &state, &work, &input), FB_OK); /* from there, not from the short way round */
  FBT_INT_EQ(work.increments, 1);
  FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
  FBT_NEAR_REL(node[20].reaction_moment[0], 35.0 * (2.5 + 4.0 * pi), FBT_TOL(1e-6, 1e-3));
}

/* E10.30, E12.4: the frequencies of a beam between hinges that is drawn taut by its tip are those of a tension EA
   strain. */
TEST(taut_strings_ring_by_the_way_of_their_end)
{
  const double stiffness[6] = {1e6, 0.0, 0.0, 1e3, 1.0, 1.0}, inertia[6] = {1.0, 1.0, 1.0, 0.01, 0.0, 0.0};
  const double strain = 1e-4;
  beam(1.0, 40, stiffness, inertia);
  desc.root = FB_END_PINNED | FB_HOLD_RX;
  desc.tip = FB_END_PINNED;
  move_support(40)->displacement[0] = (fb_real)strain;
  settle();
  spectrum_of(4);
  for (int k = 0; k < 4; k++) {
    const double n = pi * (1 + k / 2), w = n * sqrt(1e6 * strain + n * n);
    FBT_NEAR_REL(spectrum.im[k], w, FBT_TOL(2e-4, 5e-4));
  }
}

/* E12.17, E10.30: where the way of a support is what varies, the path is that of the steady states at those places. */
TEST(paths_follow_the_way_of_a_support)
{
  static fb_exact_path path;
  static fb_exact_path_work path_work;
  static fb_exact_input still, varied;
  static fb_exact_node there[FB_MAX_EXACT + 1];
  const double stiffness[6] = {1e4, 4e3, 4e3, 80.0, 100.0, 150.0};
  beam(2.0, 10, stiffness, NULL);
  desc.tip = FB_END_CLAMPED;
  load_tip(FB_AXES_INERTIAL, 0.0, 20.0, 30.0);
  input.load[0].node = 5;
  settle();
  memset(&varied, 0, sizeof varied);
  memset(&path, 0, sizeof path);
  still = input;
  varied.n_support = 1;
  varied.support[0].node = 10;
  varied.support[0].displacement[0] = -FB_R(0.8);
  varied.support[0].rotation[2] = FB_R(1.2);
  for (int k = 0; k < 12; k++) {
    FBT_INT_EQ(fb_exact_path_step(&exact, &path, &state, &path_work, &still, &varied, FB_R(0.1)), FB_OK);
  }
  FBT_BELOW(0.3, path.factor);
  FBT_INT_EQ(fb_exact_nodes_eval(&exact, there, &state), FB_OK);
  input.n_support = 1;
  input.support[0] = varied.support[0];
  input.support[0].displacement[0] *= path.factor;
  input.support[0].rotation[2] *= path.factor;
  FBT_INT_EQ(fb_exact_trim(&exact, &state, &work, &input), FB_OK);
  FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
  for (int k = 0; k <= 10; k++) {
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(node[k].position[i], there[k].position[i], FBT_TOL(1e-7, 1e-3));
      FBT_NEAR_ABS(node[k].moment[i] / FB_R(100.0), there[k].moment[i] / FB_R(100.0), FBT_TOL(1e-6, 1e-2));
    }
  }
}

/* ---- motion */

/* The beam of the mirror, `way` 1 on a base that moves, 2 seen from the other end with the base at rest: with a slide amid
   and translation, or without it in any motion. */
static void carry(fb_exact_node *seen_at, int way, int turns)
{
  const double dt = 0.01;
  any_beam(way == 1 ? 0 : 2, 0);
  desc.dissipation = FB_R(0.0);
  if (turns) {
    desc.n_support = 0;
    memset(desc.support, 0, sizeof desc.support);
  }
  memset(input.v, 0, sizeof input.v);
  memset(input.w, 0, sizeof input.w);
  memset(input.line, 0, sizeof input.line);
  input.load[2].axes = FB_AXES_INERTIAL; /* not of the base, which is not the same */
  settle();
  for (int k = 0; k < 200; k++) {
    const double t = (k + 0.5) * dt, across = turns ? 0.0 : 1.0;
    const double v[3] = {0.2 * sin(3.0 * t) * across, 0.5 * sin(2.0 * t) * across, 0.3 * sin(t)};
    const double w = turns ? 0.7 * sin(2.5 * t) : 0.0;
    for (int i = 0; i < 3 && way == 1; i++) {
      input.v[i] = (fb_real)v[i];
      input.w[i] = (fb_real)(i == 2 ? w : 0.0);
    }
    if (way == 2) {
      fb_support_place *const tip = &input.support[0], *const amid = &input.support[1];
      input.n_support = turns ? 1 : 2;
      tip->node = 6;
      for (int i = 0; i < 3; i++) {
        tip->displacement[i] += (fb_real)(dt * (i < 2 ? -v[i] : v[i]));
      }
      tip->rotation[2] += (fb_real)(dt * w);
      amid->node = 2;
      amid->displacement[1] = tip->displacement[1];
    }
    if (steps(1, dt) != FB_OK) {
      return;
    }
  }
  FBT_INT_EQ(fb_exact_nodes_eval(&exact, seen_at, &state), FB_OK);
}

/* E10.30, E10.17: a root that the base takes along, and the same beam from its other end, its tip taken along as a
   support while the base rests. */
TEST(a_moved_tip_is_a_moved_base_seen_from_the_other_end)
{
  static fb_exact_node first[FB_MAX_EXACT + 1];
  for (int turns = 0; turns < 2; turns++) {
    carry(first, 1, turns);
    carry(node, 2, turns);
    FBT_BELOW(0.4, first[0].position[2]);
    for (int k = 0; k <= 6; k++) {
      for (int i = 0; i < 3; i++) {
        const double flip = i < 2 ? -1.0 : 1.0;
        FBT_NEAR_ABS(node[6 - k].position[i] * (fb_real)flip, first[k].position[i], FBT_TOL(2e-5, 1e-4));
        FBT_NEAR_ABS(node[6 - k].reaction_force[i] * (fb_real)flip, first[k].reaction_force[i], FBT_TOL(5e-5, 2e-3));
        FBT_NEAR_ABS(node[6 - k].reaction_moment[i] * (fb_real)flip, first[k].reaction_moment[i], FBT_TOL(5e-5, 2e-3));
      }
    }
  }
}

/* E10.30, E11.20: what moved supports do is the energy that a beam gains, and what comes back where they stay is none:
   sum of reaction times velocity. */
TEST(moved_supports_work_as_much_as_energy_grows)
{
  const double stiffness[6] = {1e4, 4e3, 4e3, 80.0, 100.0, 150.0}, inertia[6] = {1.0, 1.0, 1.0, 1e-2, 5e-3, 5e-3};
  const double dt = 0.01;
  double before, done = 0.0, most = 0.0, worst = 0.0, off = 0.0;
  fb_support_place *tip, *amid;
  beam(4.0, 12, stiffness, inertia);
  desc.iterations = 12;
  desc.tip = FB_END_CLAMPED;
  desc.n_support = 1;
  desc.support[0].node = 5;
  desc.support[0].held = FB_END_PINNED;
  desc.n_lump = 1;
  desc.lump[0].node = 12;
  desc.lump[0].mass = FB_R(2.0);
  settle();
  tip = move_support(12);
  amid = move_support(5);
  before = total_energy();
  for (int k = 1; k <= 600; k++) {
    const double t = fmin(k * dt, 4.0), rise = 1.0 - cos(0.5 * pi * t); /* 4 s there and back twice.. */
    amid->displacement[2] = (fb_real)(0.2 * sin(0.5 * pi * t) * sin(0.5 * pi * t));
    tip->displacement[0] = (fb_real)(-0.3 * rise);
    tip->displacement[1] = (fb_real)(0.5 * rise);
    tip->rotation[0] = (fb_real)(0.4 * rise);
    tip->rotation[1] = amid->displacement[2]; /* about another axis at each time */
    tip->rotation[2] = (fb_real)(0.6 * rise);
    if (steps(1, dt) != FB_OK) {
      return;
    }
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    for (int j = 5; j <= 12; j += 7) {
      for (int i = 0; i < 3; i++) {
        done += dt * ((double)node[j].reaction_force[i] * (double)node[j].velocity[i] +
                      (double)node[j].reaction_moment[i] * (double)node[j].angular_rate[i]);
      }
    }
    off = fmax(off, distance(node[12].displacement, (double)tip->displacement[0], (double)tip->displacement[1], 0.0));
    off = fmax(
        off, distance(node[12].rotation, (double)tip->rotation[0], (double)tip->rotation[1], (double)tip->rotation[2]));
    most = fmax(most, total_energy() - before);
    worst = fmax(worst, fabs(total_energy() - before - done));
  }
  FBT_BELOW(90.0, most);
  FBT_ZERO(worst, most, FBT_TOL(1e-11, 1e-5));
  FBT_ZERO(off, 1.0, FBT_TOL(1e-5, 1e-4));
}

/* E10.30, E11.56: in gravity energy is constant again where supports rest, away from where they are built. */
TEST(supports_that_rest_again_do_no_work_in_gravity)
{
  const double stiffness[6] = {1e4, 4e3, 4e3, 80.0, 100.0, 150.0}, inertia[6] = {1.0, 1.0, 1.0, 1e-2, 5e-3, 5e-3};
  double moved = 0.0, worst = 0.0;
  fb_support_place *tip;
  beam(4.0, 12, stiffness, inertia);
  desc.iterations = 12;
  desc.factorizations = 2;
  desc.tip = FB_END_PINNED;
  desc.gravity[2] = -FB_R(5.0);
  settle();
  tip = move_support(12);
  for (int k = 1; k <= 400; k++) {
    const double rise = 1.0 - cos(pi * fmin(0.01 * k, 1.0));
    tip->displacement[0] = (fb_real)(-0.2 * rise);
    tip->displacement[2] = (fb_real)(0.3 * rise);
    if (steps(1, 0.01) != FB_OK) {
      return;
    }
    moved = k == 100 ? total_energy() : moved;
    worst = k > 100 ? fmax(worst, fabs(total_energy() - moved)) : worst;
  }
  FBT_BELOW(1.0, moved);
  FBT_ZERO(worst, moved, FBT_TOL(1e-11, 1e-5));
}

/* E10.17, E10.30: in a base that turns a support that moves keeps to its place in it, to the order of the step. */
TEST(supports_move_in_a_base_that_turns)
{
  const double stiffness[6] = {1e4, 4e3, 4e3, 80.0, 100.0, 150.0}, inertia[6] = {1.0, 1.0, 1.0, 1e-2, 5e-3, 5e-3};
  double off = 0.0;
  fb_support_place *tip;
  beam(4.0, 12, stiffness, inertia);
  desc.iterations = 12;
  desc.tip = FB_END_PINNED;
  input.w[2] = FB_R(1.5);
  settle();
  tip = move_support(12);
  for (int k = 1; k <= 200; k++) {
    const double rise = 1.0 - cos(0.5 * pi * 0.01 * k);
    tip->displacement[0] = (fb_real)(-0.3 * rise);
    tip->displacement[1] = (fb_real)(0.5 * rise);
    if (steps(1, 0.01) != FB_OK) {
      return;
    }
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    off = fmax(off, distance(node[12].displacement, (double)tip->displacement[0], (double)tip->displacement[1], 0.0));
  }
  FBT_ZERO(off, 1.0, FBT_TOL(1e-4, 1e-4));
}

/* E10.30, E11.20: a beam between hinges whose tip is moved across by g = a (1 - cos W t) moves as the modal sum
   w = x/L g + sum q sin(n pi x/L), q_tt + w_n^2 q = -2 (-1)^(n+1)/(n pi) g_tt. */
TEST(a_shaken_end_moves_the_beam_as_modes_do)
{
  const double stiffness[6] = {1e4, 0.0, 0.0, 10.0, 10.0, 10.0}, inertia[6] = {1.0, 1.0, 1.0, 0.01, 0.0, 0.0};
  const double dt = 0.002, a = 1e-3, W = 12.0;
  double error = 0.0, most = 0.0;
  beam(1.0, 20, stiffness, inertia);
  desc.root = FB_END_PINNED | FB_HOLD_RX;
  desc.tip = FB_HOLD_Y | FB_HOLD_Z;
  settle();
  (void)move_support(20);
  for (int k = 1; k <= 1000; k++) {
    const double t = k * dt;
    double w = 0.5 * a * (1.0 - cos(W * t));
    input.support[0].displacement[2] = (fb_real)(2.0 * w);
    if (steps(1, dt) != FB_OK) {
      return;
    }
    for (int n = 1; n < 30; n += 2) {
      const double wn = n * n * pi * pi * sqrt(10.0), c = 2.0 / (n * pi) * (n % 4 == 1 ? 1.0 : -1.0);
      w -= c * a * W * W * (cos(W * t) - cos(wn * t)) / (wn * wn - W * W);
    }
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    error = fmax(error, fabs((double)node[10].displacement[2] - w));
    most = fmax(most, fabs(w));
  }
  FBT_ZERO(error, most, FBT_TOL(5e-3, 2e-2));
}

/* Interface: places of supports that do not exist, along what is not held, or that are not numbers are refused, and the
   state stays. */
TEST(places_of_nothing_are_refused)
{
  static fb_exact_state before;
  elastica(4);
  desc.station[0].stiffness[0] = FB_R(100.0);
  desc.tip = FB_END_PINNED;
  settle();
  before = state;
  for (int k = 0; k < 6; k++) {
    const fb_status refused = k == 3 ? FB_ERR_NOT_FINITE : k == 5 ? FB_ERR_CAPACITY : FB_ERR_VALUE;
    memset(input.support, 0, sizeof input.support);
    input.n_support = k == 5 ? FB_MAX_LUMPS + 1 : 1;
    input.support[0].node = k == 0 ? 0 : k == 1 ? 2 : k == 4 ? 5 : 4;
    input.support[0].rotation[1] = k == 2 ? FB_R(0.1) : FB_R(0.0);
    input.support[0].displacement[1] = k == 3 ? (fb_real)NAN : FB_R(0.0);
    FBT_INT_EQ(fb_exact_step(&exact, &state, &work, &input, FB_R(0.01)), refused);
    FBT_INT_EQ(fb_exact_trim(&exact, &state, &work, &input), refused);
    FBT_TRUE(memcmp(&before, &state, sizeof state) == 0);
  }
  input.n_support = 0;
  desc.tip = FB_END_CLAMPED;
  desc.station[0].stiffness[7] = desc.station[0].stiffness[14] = FB_R(100.0);
  settle();
  before = state;
  move_support(4)->rotation[0] = FB_R(3.1); /* or the other way round? */
  FBT_INT_EQ(fb_exact_step(&exact, &state, &work, &input, FB_R(0.01)), FB_ERR_VALUE);
  FBT_TRUE(memcmp(&before, &state, sizeof state) == 0);
  state.n_support = FB_MAX_LUMPS + 1;
  FBT_INT_EQ(fb_exact_state_check(&exact, &state), FB_ERR_CAPACITY);
}

SUITE(exact_supports, RUN(slack_lines_hang_as_catenaries), RUN(settled_and_turned_supports_pull_as_in_closed_form),
      RUN(taut_strings_ring_by_the_way_of_their_end), RUN(paths_follow_the_way_of_a_support),
      RUN(a_moved_tip_is_a_moved_base_seen_from_the_other_end), RUN(moved_supports_work_as_much_as_energy_grows),
      RUN(supports_that_rest_again_do_no_work_in_gravity), RUN(supports_move_in_a_base_that_turns),
      RUN(a_shaken_end_moves_the_beam_as_modes_do), RUN(places_of_nothing_are_refused))
