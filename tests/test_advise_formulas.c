/* >>advise: selection of modes, what the advice estimates, in closed form. */
#include "advise.h"

static fb_shape other;
static fb_body body, twin;
static fb_body_work body_work;

/* Whether out[k, l] = in[coordinate[k], coordinate[l]], each `width` reals, of 7 x 7. */
static int pairs_follow(const fb_real *out, const fb_real *in, int width, const int coordinate[3])
{
  int follow = 1;
  for (int i = 0; i < 9 * width; i++) {
    const int k = i / (3 * width), l = i / width % 3;
    follow &= !(fabs((double)(out[i] - in[(7 * coordinate[k] + coordinate[l]) * width + i % width])) > 0.0);
  }
  return follow;
}

/* E8.38: also what a straight beam leaves zero goes with its coordinates. */
TEST(selection_takes_rows_and_pairs)
{
  static fb_modes modes;
  const int coordinate[3] = {1, 4, 6};
  make_boom(&shape, &modes, 4, 3);
  fbt_seed(5);
  fbt_fill(shape.second.reach, 7, 1.0);
#if FB_WITH_ACCELERATION_STIFFENING
  fbt_fill(shape.second.hchi, 3 * 49, 1.0);
#endif
#if FB_WITH_NONLINEAR_STRAIN
  fbt_fill(shape.slope, FBT_COUNT(shape.slope), 1.0);
#endif
  FBT_INT_EQ(fb_shape_select(&other, &shape, coordinate, 3), FB_OK);
  for (int k = 0; k < 3; k++) {
    FBT_NEAR_ABS(other.second.reach[k], shape.second.reach[coordinate[k]], 0.0);
  }
#if FB_WITH_ACCELERATION_STIFFENING
  FBT_TRUE(pairs_follow(other.second.hchi, shape.second.hchi, 3, coordinate));
#endif
#if FB_WITH_NONLINEAR_STRAIN
  for (int k = 0; k < 3; k++) {
    const int width = FBT_COUNT(shape.slope) / FB_MAX_MODES;
    FBT_NEAR_ABS(fbt_difference(other.slope + width * k, shape.slope + width * coordinate[k], width), 0.0, 0.0);
  }
#endif
  FBT_TRUE(pairs_follow(other.K, shape.K, 1, coordinate));
}

/* E8.38: modes chosen from many make the body that those modes alone make. */
TEST(selected_modes_move_as_a_body_of_their_own)
{
  static fb_modes many, few;
  static fb_shape chosen;
  fb_state state;
  fb_motion a, b;
  fb_node_motion at, bt;
  fb_input input;
  const fb_real v[3] = {FB_R(0.3), -FB_R(0.2), FB_R(0.1)}, w[3] = {FB_R(1.0), FB_R(0.5), -FB_R(2.0)};
  int coordinate[3], n = 0;
  make_boom(&shape, &many, 4, 3);
  make_boom(&other, &few, 2, 1);
  for (int k = 0; k < many.n; k++) {
    for (int j = 0; j < few.n; j++) {
      if (fabs((double)(many.omega[k] / few.omega[j]) - 1.0) < 1e-3) {
        coordinate[n++] = k;
      }
    }
  }
  FBT_INT_EQ(n, 3);
  FBT_INT_EQ(fb_shape_select(&chosen, &shape, coordinate, 3), FB_OK);
  FBT_INT_EQ(chosen.n, 3);
  memset(&level, 0, sizeof level);
  level.effects = FB_EFFECTS_FULL;
  level.base = FB_BASE_PRESCRIBED;
  FBT_INT_EQ(fb_body_init(&body, &body_work, &chosen, &level), FB_OK);
  FBT_INT_EQ(fb_body_init(&twin, &body_work, &other, &level), FB_OK);
  memset(&input, 0, sizeof input);
  input.n_load = 1;
  input.load[0].node = 1;
  input.load[0].force[1] = FB_R(3.0);
  memcpy(input.v, v, sizeof v);
  memcpy(input.w, w, sizeof w);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  for (int k = 0; k < 3; k++) {
    state.q[k] = FB_R(0.02) * (fb_real)(k + 1);
  }
  FBT_INT_EQ(fb_body_motion_eval(&body, &a, &state, &input), FB_OK);
  FBT_INT_EQ(fb_body_motion_eval(&twin, &b, &state, &input), FB_OK);
  FBT_BELOW(fbt_difference(a.q_ddot, b.q_ddot, 3), FBT_TOL(1e-9, 2e-2));
  FBT_BELOW(fbt_difference(a.reaction_torque, b.reaction_torque, 3), FBT_TOL(1e-9, 1e-2));
  FBT_INT_EQ(fb_body_node_motion_eval(&body, &at, &state, &a, 1), FB_OK);
  FBT_INT_EQ(fb_body_node_motion_eval(&twin, &bt, &state, &b, 1), FB_OK);
  FBT_BELOW(fbt_difference(at.displacement, bt.displacement, 3), FBT_TOL(1e-12, 1e-5));
  FBT_BELOW(fbt_difference(at.rotation, bt.rotation, 3), FBT_TOL(1e-12, 1e-5));
}

/* Interface: coordinates that are not there, or twice; no output. */
TEST(selection_refuses_nonsense)
{
  static fb_modes modes;
  const int twice[2] = {1, 1}, beyond[1] = {3}, good[2] = {0, 2};
  make_boom(&shape, &modes, 3, 0);
  other.n = -5;
  FBT_INT_EQ(fb_shape_select(&other, &shape, twice, 2), FB_ERR_VALUE);
  FBT_INT_EQ(fb_shape_select(&other, &shape, beyond, 1), FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_shape_select(&other, &shape, good, 4), FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_shape_select(&other, &shape, good, -1), FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_shape_select(NULL, &shape, good, 2), FB_ERR_NULL);
  FBT_INT_EQ(fb_shape_select(&shape, &shape, good, 2), FB_ERR_NULL);
  FBT_INT_EQ(other.n, -5);
  FBT_INT_EQ(fb_shape_select(&other, &shape, NULL, 0), FB_OK); /* rigid */
  FBT_INT_EQ(other.n, 0);
}

/* E13.1: F L^3/(3 EI) at rest, twice that after a jump, 1/(1 - r^2) of it near a frequency; about a spin the steady
   state of fb_body_trim. */
TEST(advice_estimates_the_deflection)
{
  static fb_analyse_work analyse;
  const double rest = 0.5 * 27.0 / (3.0 * 500.0);
  fb_state state;
  fb_input input;
  fb_motion motion;
  fb_node_motion tip;
  boom_under_a_force(0.5, 0, 6);
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_OK);
  FBT_NEAR_REL(advice.deflection, rest, 3e-4); /* what six modes have of it */
  envelope.frequency = FB_HUGE;
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_OK);
  FBT_NEAR_REL(advice.deflection, 2.0 * rest, 1e-3);
  envelope.frequency = FB_R(0.5) * (fb_real)sqrt((double)shape.K[0]);
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_OK);
  FBT_NEAR_REL(advice.deflection, rest / 0.75, 1e-2);
  envelope.frequency = FB_R(0.0);
  envelope.spin[1] = FB_R(6.0); /* about y: bends in the plane of rotation */
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_OK);
  memset(&input, 0, sizeof input);
  input.n_load = 1;
  input.load[0] = envelope.load[0];
  input.w[1] = FB_R(6.0);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  FBT_INT_EQ(fb_body_trim(&body, &state, &analyse, &input), FB_OK);
  FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &input), FB_OK);
  FBT_INT_EQ(fb_body_node_motion_eval(&body, &tip, &state, &motion, 1), FB_OK);
  FBT_NEAR_REL(advice.deflection, fabs((double)tip.displacement[2]), FBT_TOL(1e-4, 1e-3));
  FBT_BELOW(advice.deflection, 0.95 * rest);
}

/* E13.1: a tip force, an angular acceleration a of the root and an acceleration b bend the boom by F L^3/(3 EI),
   11 m a L^5/(120 EI) and m b L^4/(8 EI); b of either sign; not while it spins, which would stiffen it; the force alone
   where the others oppose it. At resonance the first mode's part, 0.9707, grows by omega t/2, with damping to 1/(2
   zeta). */
TEST(what_acts_adds_up_at_its_worst)
{
  const double rest = 0.5 * 27.0 / 1500.0, turned = 11.0 * 2.0 * 0.05 * 243.0 / (120.0 * 500.0);
  const double moved = 2.0 * 0.05 * 81.0 / (8.0 * 500.0);
  double other_modes;
  boom_under_a_force(0.5, 0, 6);
  envelope.spin[1] = FB_R(6.0);
  envelope.spin_rate[1] = FB_R(0.05);
  FBT_NEAR_REL(deflection(), rest + turned, 1e-3);
  envelope.spin_rate[1] = -FB_R(0.05);
  FBT_NEAR_REL(deflection(), rest, 1e-3);
  envelope.spin_rate[1] =
      FB_R(0.05); /* once more by the spin; what the first mode lacks is the most of the force alone */
  envelope.spin[0] = FB_R(0.025);
  envelope.spin[1] = FB_R(0.0);
  envelope.spin[2] = -FB_R(2.0);
  FBT_NEAR_REL(deflection() * (double)work.error_modes[0], (1.0 - 0.9707) * rest, 1e-2);
  envelope.spin[0] = envelope.spin[2] = envelope.spin_rate[1] = FB_R(0.0);
  envelope.acceleration[2] = FB_R(0.05);
  FBT_NEAR_REL(deflection(), rest + moved, 1e-3);
  envelope.acceleration[2] = -FB_R(0.05);
  FBT_NEAR_REL(deflection(), rest + moved, 1e-3);
  envelope.spin[1] = FB_R(6.0);
  envelope.spin_rate[1] = FB_R(0.05);
  FBT_NEAR_REL(deflection(), rest + turned + moved, 1e-3);
  envelope.spin[1] = envelope.spin_rate[1] = envelope.acceleration[2] = FB_R(0.0);
  envelope.frequency = (fb_real)sqrt((double)shape.K[0]);
  envelope.duration = FB_R(8.0) / envelope.frequency;
  FBT_NEAR_REL(deflection(), (1.0 + 3.0 * 0.9707) * rest, 1e-2);
  level.effects |= (unsigned)FB_EFFECT_DAMPING;
  level.zeta[0] = FB_R(1.0) / FB_R(6.0);
  FBT_NEAR_REL(deflection(), (1.0 + 2.0 * 0.9707) * rest, 1e-2);
  other_modes = (1.0 - 0.9707) / (1.0 + 2.0 * 0.9707); /* far from resonance: 1/(1 - r) of it at most, r = 1/6.27 */
  FBT_TRUE((double)work.error_modes[0] > other_modes && (double)work.error_modes[0] < 1.19 * other_modes);
}

/* E13.1: below its frequency a mode answers by 1/(1 - r^2), next to it with damping by 1/(2 zeta r); above it as to a
   jump. */
TEST(modes_answer_as_oscillators)
{
  const double rest = 0.5 * 27.0 / 1500.0, r[3] = {0.8, 0.99, 1.5}, gain[3] = {1.0 / 0.36, 1.0 / 0.198, 2.0};
  for (int k = 0; k < 3; k++) {
    boom_under_a_force(0.5, 0, 6);
    envelope.frequency = (fb_real)(r[k] * sqrt((double)shape.K[0]));
    envelope.duration = FB_R(100.0) / envelope.frequency;
    level.effects |= (unsigned)FB_EFFECT_DAMPING;
    level.zeta[0] = FB_R(0.1);
    FBT_NEAR_REL(deflection(), (1.0 + (gain[k] - 1.0) * 0.9707) * rest, 1e-2);
  }
}

/* E13.3, E13.9: a rate and an acceleration so small that they matter to nothing leave the advice about a spin askew as
   it is, though it is no longer steady; of the acceleration either sign. */
TEST(a_rate_too_small_to_matter_changes_no_advice)
{
  static fb_advice steady;
  static fb_real error[FBI_ADVICE_SETS], modes[6];
  for (int unsteady = 0; unsteady < 3; unsteady++) {
    boom_under_a_force(-0.5, 3, 3);
    envelope.spin[0] = FB_R(0.2);
    envelope.spin[2] = -FB_R(4.0);
    envelope.frequency = FB_R(0.5);
    envelope.acceleration[2] = unsteady < 2 ? FB_R(0.1) : -FB_R(0.1);
    envelope.spin_rate[0] = unsteady ? FB_R(1e-9) : FB_R(0.0);
    (void)deflection();
    if (!unsteady) {
      steady = advice;
      memcpy(error, work.error, sizeof error);
      memcpy(modes, work.error_modes, sizeof modes);
    }
    FBT_NEAR_REL(advice.deflection, steady.deflection, FBT_TOL(1e-6, 1e-3));
    FBT_NEAR_REL(advice.dt, steady.dt, FBT_TOL(1e-5, 1e-2));
    FBT_BELOW(fbt_difference(work.error, error, FBI_ADVICE_SETS), FBT_TOL(2e-5, 1e-2) * fbt_largest(error, 3));
    FBT_BELOW(fbt_difference(work.error_modes, modes, 6), FBT_TOL(1e-6, 1e-3));
  }
}

/* E13.1: where the second mode has its node, at 0.7834 L, it gives nothing of the output: the third is taken before it.
   An acceleration bends the boom there by m a x^2 (6 L^2 - 4 L x + x^2)/(24 EI). */
TEST(modes_are_taken_by_what_they_give)
{
  const double x = 3.0 * 0.783445;
  boom_output = FB_R(0.783445);
  boom_under_a_force(0.0, 0, 6);
  envelope.acceleration[2] = FB_R(1e-3);
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(4e-4)), FB_OK);
  FBT_NEAR_REL(advice.deflection, 2.0 * 1e-3 * x * x * (54.0 - 12.0 * x + x * x) / (24.0 * 500.0), 1e-3);
  FBT_INT_EQ(advice.n, 2);
  FBT_INT_EQ(advice.coordinate[0], 0);
  FBT_INT_EQ(advice.coordinate[1], 2);
  boom_output = FB_R(1.0);
}

/* E13.6: two modes a, b of the booms of a body that flies have the inertia delta_ab - p_a.p_b/m - h_a.h_b/J with their
   momenta p, h about the mass center: of the first mode of a uniform cantilever 0.78299 sqrt(mL), 0.56883 L sqrt(mL).
   One that turns about the hub has the second term alone, a held one neither. */
TEST(inertia_of_modes_is_less_by_the_recoil)
{
  const double p2 = 0.78299 * 0.78299 * 2.5, h2 = 0.56883 * 0.56883 * 25.0 * 2.5;
  const double m = 105.0, J = 20.0 + 2.0 * 0.5 * 125.0 / 3.0;
  const fb_base base[4] = {FB_BASE_FREE, FB_BASE_PINNED, FB_BASE_HINGED, FB_BASE_PRESCRIBED};
  for (int k = 0; k < FBT_COUNT(base); k++) {
    const double moves = k == 0 ? p2 / m : 0.0, turns = k < 3 ? h2 / J : 0.0, tips = k < 2 ? h2 / J : 0.0;
    make_two_booms(1, 1);
    level.base = base[k];
    envelope.load[0].node = 1;
    envelope.load[0].force[1] = envelope.load[0].force[2] = FB_R(0.1);
    (void)deflection();
    for (int a = 0; a < 4; a++) { /* y and z of a boom, y and z of the other, turned by pi about z */
      const double turn = a % 2 ? tips : turns, across = a % 2 ? turn - moves : moves - turn;
      FBT_NEAR_ABS(work.inertia[5 * a], 1.0 - moves - turn, FBT_TOL(1e-4, 1e-3));
      FBT_NEAR_ABS(work.inertia[4 * a + (a + 2) % 4], across, FBT_TOL(1e-4, 1e-3));
      FBT_NEAR_ABS(work.inertia[4 * a + (a ^ 1)], 0.0, FBT_TOL(1e-9, 1e-4));
    }
  }
}

/* E13.7, E13.8: with a mode each, two booms move as their sum, from which the hub moves, and their difference, from
   which it turns: omega_0^2/(1 - 2 p^2/m), omega_0^2/(1 - 2 h^2/J). A torque about z drives the difference, by
   T h/J, equally by both; a force on the hub the sum, by F p/m. Half of it alone recoils less. */
TEST(two_booms_move_as_their_sum_and_difference)
{
  const double p = 0.78299 * sqrt(2.5), h = 0.56883 * 5.0 * sqrt(2.5), tip = 2.0 / sqrt(2.5);
  const double m = 105.0, J = 20.0 + 2.0 * 0.5 * 125.0 / 3.0;
  for (int turns = 0; turns < 2; turns++) {
    const double sum = 1.0 - 2.0 * p * p / m, difference = 1.0 - 2.0 * h * h / J;
    const double alone = 1.0 - p * p / m - h * h / J;
    double omega2, bend;
    make_two_booms(1, 0);
    envelope.load[0].force[1] = turns ? FB_R(0.0) : FB_R(0.2);
    envelope.load[0].torque[2] = turns ? FB_R(0.2) : FB_R(0.0);
    omega2 = (double)shape.K[0];
    bend = 0.2 * tip * (turns ? h / J : p / m) / omega2;
    FBT_NEAR_REL(deflection(), bend, FBT_TOL(1e-3, 1e-2)); /* quasi-static */
    FBT_NEAR_REL(work.omega[1][0] * work.omega[1][0], omega2 / sum, FBT_TOL(1e-3, 1e-2));
    FBT_NEAR_REL(work.omega[1][1] * work.omega[1][1], omega2 / difference, FBT_TOL(1e-3, 1e-2));
    FBT_NEAR_REL(work.omega[0][0] * work.omega[0][0], omega2 / alone, FBT_TOL(1e-3, 1e-2));
    FBT_NEAR_REL(work.score[0], 1.5 * bend, FBT_TOL(1e-3, 1e-2));
    FBT_NEAR_REL(work.score[1], 0.5 * bend, FBT_TOL(1e-3, 1e-2));
    FBT_NEAR_REL(work.give[0], bend, FBT_TOL(1e-3, 1e-2));
    FBT_NEAR_ABS(work.give[1], 0.0, 0.0);
    FBT_NEAR_ABS(work.error_modes[0], 0.0, FBT_TOL(1e-6, 1e-3)); /* statically one boom does */
    envelope.frequency = FB_HUGE;
    envelope.duration = FB_R(1e3);
    FBT_NEAR_REL(deflection(), 2.0 * bend, FBT_TOL(1e-3, 1e-2));
    FBT_NEAR_ABS(work.error_modes[0], 1.0, 0.06); /* phases are lost */
  }
}

/* As many modes as a body can have, the last of them damped: E13.1 near its frequency adds its part c of the force's
   work times 1/(2 zeta), so that half the damping adds as much again. */
TEST(advice_takes_as_many_modes_as_there_can_be)
{
  const fb_real push[2] = {FB_R(0.5), FB_R(0.0)}; /* in the stiffer plane */
  double bend[3];
  for (int k = 0; k < 3; k++) {
    const int last = FB_MAX_MODES - 1;
    boom_under_a_force(0.5, FB_MAX_MODES / 2, FB_MAX_MODES / 2);
    FBT_INT_EQ(shape.n, FB_MAX_MODES);
    memset(&work, 0xff, sizeof work);
    memcpy(envelope.load[0].force + 1, push, sizeof push);
    envelope.duration = FB_R(1e5);
    level.effects |= (unsigned)FB_EFFECT_DAMPING;
    level.zeta[last] = FB_R(1e-5) / (fb_real)(1 << k);
    envelope.frequency = (fb_real)sqrt((double)shape.K[last * FB_MAX_MODES + last]);
    bend[k] = deflection();
  }
  FBT_BELOW(1.01 * bend[0], bend[1]);
  FBT_NEAR_REL(bend[2] - bend[1], 2.0 * (bend[1] - bend[0]), 0.1); /* it shortens, too */
}

/* v of the axes in which the boom lies: x, y, z become y, z, x, as often. */
static void put(fb_real v[3], double x, double y, double z, int axes)
{
  v[axes % 3] = (fb_real)x;
  v[(axes + 1) % 3] = (fb_real)y;
  v[(axes + 2) % 3] = (fb_real)z;
}

/* E13.1, E13.3: the same scene in other axes of the body, held and free, has the same advice. */
TEST(advice_knows_no_axes)
{
  const fb_real half = FB_R(0.5), inertia[6] = {2, 2, 2, 0, 0, 0};
  const fb_real attitude[3][4] = {{1, 0, 0, 0}, {half, half, half, half}, {half, -half, -half, -half}};
  for (int run = 0; run < 6; run++) {
    static fb_advice first;
    static fb_real error[FBI_ADVICE_SETS], modes[3];
    const int axes = run % 3, held = run / 3;
    fb_real center[3], drift[3];
    memcpy(boom_attitude, attitude[axes], sizeof boom_attitude);
    boom_under_a_force(0.0, 1, 2);
    put(envelope.load[0].force, 0.3, 0.2, -0.5, axes);
    put(envelope.spin, 0.4, -0.7, 0.5, axes);
    put(envelope.acceleration, 0.5, 0.1, 0.2, axes);
    put(envelope.velocity, 0.03, 0.02, -0.04, axes);
    put(envelope.spin_rate, held ? 0.02 : 0.0, held ? 0.03 : 0.0, held ? -0.05 : 0.0, axes);
    envelope.frequency = FB_R(0.5);
    level.base = held ? FB_BASE_PRESCRIBED : FB_BASE_FREE;
    put(center, 0.5, 0.2, 0.3, axes);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(20.0), center, inertia), FB_OK);
    (void)deflection();
    fb_vec3_cross(drift, work.motion.w, shape.c);
    for (int i = 0; i < 3 && !held; i++) { /* it turns about its mass center */
      FBT_NEAR_ABS(work.motion.v[i] + drift[i] / shape.mass, 0.0, 1e-5);
      FBT_BELOW(0.01, fabs((double)work.motion.v[i]));
    }
    if (axes == 0) {
      first = advice;
      memcpy(error, work.error, sizeof error);
      memcpy(modes, work.error_modes, sizeof modes);
    }
    FBT_INT_EQ(advice.effects, first.effects);
    FBT_INT_EQ(advice.n, first.n);
    FBT_INT_EQ(advice.integrator, first.integrator);
    FBT_NEAR_REL(advice.deflection, first.deflection, FBT_TOL(1e-6, 1e-3));
    FBT_NEAR_REL(advice.dt, first.dt, FBT_TOL(1e-6, 1e-2));
    FBT_NEAR_REL(advice.error_model, first.error_model, FBT_TOL(1e-6, 1e-2));
    for (int set = 0; set < FBI_ADVICE_SETS; set++) { /* of some so large that they would hide the others */
      FBT_NEAR_REL(work.error[set], error[set], FBT_TOL(1e-6, 1e-2));
    }
    FBT_BELOW(fbt_difference(work.error_modes, modes, 3), FBT_TOL(1e-6, 1e-3));
  }
  memcpy(boom_attitude, attitude[0], sizeof boom_attitude);
}

/* E13.1: a base that turns about a fixed point has no velocity there. */
TEST(velocities_are_those_of_a_prescribed_base)
{
  const fb_real center[3] = {0, 0, 0}, inertia[6] = {1, 1, 1, 0, 0, 0};
  double still = 0.0;
  for (int k = 0; k < 2; k++) {
    boom_under_a_force(0.5, 1, 2);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(5.0), center, inertia), FB_OK);
    envelope.spin[1] = FB_R(1.0);
    level.base = FB_BASE_PINNED;
    envelope.velocity[0] = envelope.velocity[2] = k ? FB_R(5.0) : FB_R(0.0);
    still = k ? still : deflection();
    FBT_NEAR_REL(deflection(), still, 1e-9);
  }
}

/* E13.1: compression P along the boom makes F (tan kL - kL)/(P k) of it, k^2 = P/EI (beam-column); next to buckling and
   beyond the boom answers as at rest. */
TEST(compressed_booms_bend_until_they_buckle)
{
  const double buckles = 9.8696044 * 500.0 / 36.0, rest = 5.0 * 27.0 / 1500.0;
  const double part[3] = {0.5, 0.99, 2.5};
  for (int run = 0; run < 4; run++) { /* six modes, at last one */
    const int k = run < 3 ? run : 2;
    const double P = part[k] * buckles, root = sqrt(P / 500.0);
    boom_under_a_force(5.0, 0, run < 3 ? 6 : 1);
    envelope.load[0].force[0] = (fb_real)-P;
    FBT_NEAR_REL(deflection(), k == 0 ? 5.0 * (tan(3.0 * root) - 3.0 * root) / (P * root) : rest, 0.03);
  }
}

/* Square of the frequency that a set of effects gives the only mode, spinning about an axis. */
static double squared_frequency(unsigned effects, const fb_real w[3])
{
  static fb_analyse_work analyse;
  static fb_spectrum spectrum;
  fb_state state;
  fb_input input;
  fb_body_desc desc = level;
  desc.effects = effects;
  memset(&input, 0, sizeof input);
  memcpy(input.w, w, 3 * sizeof w[0]);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  FBT_INT_EQ(fb_body_trim(&body, &state, &analyse, &input), FB_OK);
  FBT_INT_EQ(fb_body_spectrum_solve(&body, &analyse, &spectrum, &state, &input), FB_OK);
  return (double)(spectrum.im[0] * spectrum.im[0]);
}

/* Squared frequencies of the boom with its modes along z alone, under the load of the envelope. */
static void loaded_frequencies(double *squared)
{
  static fb_analyse_work analyse;
  static fb_spectrum spectrum;
  fb_state state;
  fb_input input;
  memset(&input, 0, sizeof input);
  input.n_load = 1;
  input.load[0] = envelope.load[0];
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  FBT_INT_EQ(fb_body_trim(&body, &state, &analyse, &input), FB_OK);
  FBT_INT_EQ(fb_body_spectrum_solve(&body, &analyse, &spectrum, &state, &input), FB_OK);
  FBT_INT_EQ(spectrum.n, shape.n);
  for (int k = 0; k < spectrum.n; k++) {
    squared[k] = (double)(spectrum.im[k] * spectrum.im[k]);
  }
}

/* E13.9: the first mode alone of a compressed boom is off by what the second adds to the deflection. A jump makes it
   swing by that once more, at a frequency that is too high, until phases are lost: by more than it swings, less than
   twice. E13.7: the frequencies are those of the boom under the load. */
TEST(modes_err_by_what_gives_way)
{
  const double P = 0.6 * 9.8696044 * 500.0 / 36.0; /* of what buckles it */
  double bend[2], both[2];
  for (int jump = 0; jump < 2; jump++) {
    for (int n = 1; n <= 2; n++) {
      boom_under_a_force(1e-3, 0, n);
      envelope.load[0].force[0] = (fb_real)-P;
      envelope.frequency = jump ? FB_HUGE : FB_R(0.0);
      envelope.duration = FB_R(1e4);
      bend[n - 1] = deflection();
    }
    loaded_frequencies(both);
    FBT_NEAR_REL(work.omega[1][0] * work.omega[1][0], both[0], FBT_TOL(1e-4, 1e-2));
    FBT_NEAR_REL(work.omega[1][1] * work.omega[1][1], both[1], FBT_TOL(1e-4, 1e-2));
    if (jump) {
      FBT_TRUE(work.error_modes[0] > FB_R(0.9) && work.error_modes[0] < FB_R(1.2));
    } else {
      FBT_NEAR_REL(work.error_modes[0], (bend[1] - bend[0]) / bend[1], FBT_TOL(1e-3, 5e-2));
    }
  }
}

/* E13.2, E13.3: under a steady load a set is off by the change of the squared frequency, as E12.3 has it, against the
   frequency at rest: leaving out the centrifugal stiffening by (omega^2 - omega_0^2)/omega_0^2, out of the plane of
   rotation and in it; residual inertia matters in it alone. Where modes swing, the error grows with the phase. */
TEST(sets_err_by_the_change_of_frequency)
{
  const unsigned with_spin = FB_EFFECTS_SPIN | FB_EFFECT_SPIN_STIFFENING;
  for (int axis = 1; axis <= 2; axis++) {
    double full, linear, split, rest, steady;
    boom_under_a_force(1e-3, 0, 1);
    envelope.spin[axis] = FB_R(4.0);
    rest = (double)shape.K[0];
    full = squared_frequency(FB_EFFECTS_FULL, envelope.spin);
    linear = squared_frequency(FB_EFFECTS_LINEAR, envelope.spin);
    split = squared_frequency(with_spin, envelope.spin);
    FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.001)), FB_OK);
    FBT_NEAR_ABS(linear, rest, FBT_TOL(1e-8, 0.1));
    FBT_NEAR_REL(advice.without[3], (full - linear) / rest, FBT_TOL(1e-3, 1e-2));
    FBT_NEAR_ABS(work.error[4], fabs(full - split) / rest, FBT_TOL(1e-3, 1e-2)); /* the fifth set */
    FBT_TRUE((double)advice.without[2] > 0.05 || axis == 2);
    FBT_TRUE((advice.effects & FB_EFFECT_SPIN_STIFFENING) != 0);
    FBT_TRUE(((advice.effects & FB_EFFECT_RESIDUAL_INERTIA) != 0) == (axis == 1));
    FBT_NEAR_ABS(advice.without[4], 0.0, 1e-4); /* nothing accelerates */
    steady = (double)advice.without[3];
    envelope.frequency = FB_R(0.1);
    FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.001)), FB_OK);
    FBT_TRUE((double)advice.without[3] > 1.2 * steady);
  }
}

/* E13.2, E13.3: the phase of what swings goes wrong as long as something acts: what a spin that lasts a quarter of the
   time does to the frequency (r, E12.3) takes a quarter of the phase. Where a set errs at rest, too, it goes on. */
TEST(sets_err_as_long_as_something_acts)
{
  const double part[3] = {1.0, 0.5, 0.25};
  double error[3], r;
  for (int k = 0; k < 3; k++) {
    boom_under_a_force(1e-3, 0, 1);
    envelope.spin[1] = FB_R(0.4);
    envelope.frequency = FB_R(0.1);
    envelope.lasts = (fb_real)(part[k] * (double)envelope.duration);
    FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.001)), FB_OK);
    error[k] = (double)work.error[0];
  }
  r = (squared_frequency(FB_EFFECTS_FULL, envelope.spin) - (double)shape.K[0]) / (double)shape.K[0];
  FBT_NEAR_REL(2.0 * error[2] - error[1], r, 0.02);
  FBT_NEAR_REL(error[1] - error[2], 0.25 * r * (double)work.ringing, 0.02);
  FBT_NEAR_REL(error[0] - error[1], 0.5 * r * (double)work.ringing, 0.02);
}

/* E13.4: the estimate of what every modal body is off by, of the order of what the exact beam says, under a dead force
   that bends the boom by a tenth and a fifth of its length. */
TEST(advice_knows_where_modes_end)
{
  static fb_exact exact;
  static fb_exact_desc desc;
  static fb_exact_state bent;
  static fb_exact_work exact_work;
  static fb_exact_input load;
  static fb_exact_node node[21];
  static fb_analyse_work analyse;
  static fb_section section;
  desc.length = FB_R(3.0);
  desc.n_element = 20;
  desc.n_station = 1;
  section.mass = FB_R(2.0);
  section.EI_y = FB_R(500.0);
  section.EI_z = FB_R(900.0);
  FBT_INT_EQ(fb_exact_station_init(&desc.station[0], &section), FB_OK);
  FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_OK);
  for (int run = 1; run <= 2; run++) {
    const double force = 0.1 * run * 3.0 * 500.0 / 9.0;
    fb_state state;
    fb_input input;
    fb_motion motion;
    fb_node_motion tip;
    double off = 0.0;
    boom_under_a_force(force, 0, 6);
    FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.1)), FB_OK);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    memset(&input, 0, sizeof input);
    input.n_load = 1;
    input.load[0] = envelope.load[0];
    FBT_INT_EQ(fb_body_trim(&body, &state, &analyse, &input), FB_OK);
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &input), FB_OK);
    FBT_INT_EQ(fb_body_node_motion_eval(&body, &tip, &state, &motion, 1), FB_OK);
    memset(&load, 0, sizeof load);
    load.n_load = 1;
    load.load[0].node = 20;
    load.load[0].force[2] = (fb_real)force;
    FBT_INT_EQ(fb_exact_state_init(&exact, &bent, &exact_work, &load), FB_OK);
    FBT_INT_EQ(fb_exact_trim(&exact, &bent, &exact_work, &load), FB_OK);
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &bent), FB_OK);
    for (int i = 0; i < 3; i++) {
      const double d = (double)(tip.displacement[i] - node[20].position[i]) + (i == 0 ? 3.0 : 0.0);
      off += d * d;
    }
    off = sqrt(off) / (0.1 * run * 3.0);
    FBT_BELOW(off, 4.0 * (double)advice.error_model);
    FBT_BELOW(0.25 * (double)advice.error_model, off);
  }
}

/* E13.3, E13.2: bending in one plane at a rate f makes Coriolis forces 2 s f in the other while the boom turns about
   itself by s: without spin coupling off by r = 2 s f/omega^2 and by the phase r f T/2, at most twice the output;
   the tip of a straight field does not come in by 3/5 delta/L. */
TEST(sets_err_by_what_they_lack)
{
  const double s = 0.02, f = 2.0, T = 10.0;
  double r;
  boom_under_a_force(0.5, 1, 1);
  r = 2.0 * s * f / (double)shape.K[3]; /* the stiffer plane, which the force does not bend */
  envelope.spin[0] = (fb_real)s;
  envelope.frequency = (fb_real)f;
  (void)deflection();
  FBT_NEAR_REL(advice.without[1], r * (1.0 + 0.5 * f * T), 0.05);
  FBT_NEAR_ABS(advice.without[0], 1.0, 0.0);
  envelope.duration = FB_R(1e6);
  (void)deflection();
  FBT_BELOW(advice.without[1], 2.01);
  FBT_BELOW(1.99, advice.without[1]);
  boom_under_a_force(0.05 * 3.0 * 500.0 / 9.0, 0, 6);
  (void)deflection();
  FBT_NEAR_REL(work.error[0], 0.6 * 0.05, 0.05);
}

/* E13.3: a boom that swings about its own spin s in one plane is off without the effects of spin by s^2/omega_z^2
   there, where it is bent the most, and by 2 s f/omega_y^2 across, where it moves the fastest: not both at once. */
TEST(bending_and_speed_have_their_phases)
{
  const double f = 0.2, T = 10.0;
  double s, omega_y2, omega_z2;
  boom_under_a_force(1e-3, 1, 1);
  omega_z2 = fmin((double)shape.K[0], (double)shape.K[3]);
  omega_y2 = fmax((double)shape.K[0], (double)shape.K[3]);
  s = 2.0 * f * omega_z2 / omega_y2; /* both are as large */
  envelope.spin[0] = (fb_real)s;
  envelope.frequency = (fb_real)f;
  (void)deflection();
  FBT_NEAR_REL(work.error[0], s * s / omega_z2 * (1.0 + 0.5 * f * T), FBT_TOL(1e-2, 0.1));
}

/* E13.4 as it is written, of a body without lines, about a slow spin of the boom about itself. */
TEST(model_error_is_its_formula)
{
  const double s = 0.1, f = 1.0, T = 10.0;
  double bend;
  boom_under_a_force(5.0, 0, 1);
  shape.lines_status = FB_ERR_UNSUPPORTED;
  envelope.spin[0] = (fb_real)s;
  envelope.frequency = (fb_real)f;
  bend = deflection() / 3.0;
  FBT_NEAR_REL(advice.error_model, 1.2 * bend * s * f / (double)shape.K[0] + 0.3 * bend * bend * (1.0 + 0.125 * f * T),
               0.01);
  memset(shape.node[1].psi, 0, sizeof shape.node[1].psi); /* an output where no mode gives anything of first degree */
  envelope.acceleration[2] = FB_R(1.0);
  bend = deflection() / 3.0;
  FBT_NEAR_REL(advice.error_model, 0.3 * bend * bend, 0.01);
}

/* E13.4, E13.40: a dead force that bends the boom by a fifth of its length takes large deflection for 1 %, not for 10 %, one
   that bends it by 2 % takes it for neither; of a beam without lines the advice is what it would be without the effect,
   and says that it misses. What is beyond 5 lengths is not known. */
TEST(large_deflection_has_no_error_of_the_field)
{
#if FB_WITH_LARGE_DEFLECTION
  const double unit = 3.0 * 500.0 / 9.0; /* [N] bends it by its length, linearly */
  const double tolerance[2] = {0.1, 0.01}, bend[3] = {0.02, 0.2, 6.0};
  for (int k = 0; k < 6; k++) {
    const int large = k == 3;
    boom_under_a_force(bend[k / 2] * unit, 0, 6);
    FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, (fb_real)tolerance[k % 2]), FB_OK);
    FBT_INT_EQ(advice.effects == FB_EFFECTS_LARGE, large);
    if (k < 4) { /* elastica: (delta/L)^2 36/35 of its deflection, to second degree */
      FBT_NEAR_REL(advice.error_field, 36.0 / 35.0 * pow(bend[k / 2], 2.0), 0.03);
    } else {                                                              /* beyond the limit E13.4 */
      FBT_NEAR_REL(advice.error_field, 0.3 * pow(bend[k / 2], 2.0), 0.1); /* the tip comes in, too */
    }
    FBT_NEAR_ABS(advice.error_model, large ? 0.0 : (double)advice.error_field, 0.0);
    FBT_INT_EQ((double)advice.error <= tolerance[k % 2] * 1.00001, k < 4);
    if (large) {
      const fb_real cost = advice.cost;
      fb_advice rough;
      shape.lines_status = FB_ERR_UNSUPPORTED; /* as of a beam that cannot have any */
      FBT_INT_EQ(fb_advice_solve(&rough, &work, &shape, &level, &envelope, FB_R(0.01)), FB_OK);
      FBT_INT_EQ(rough.effects & FB_EFFECT_LARGE_DEFLECTION, 0);
      FBT_TRUE(rough.error > FB_R(0.01));
      FBT_TRUE(rough.cost < cost);
    }
  }
#endif
}

/* E13.5: the boom turns about z and moves along z, across its axis and the spin, with a speed that draws its tip in by
   1.2 delta delta_rate/L: times 2 s that is an acceleration along y, and bends the boom there. Modes for that are taken,
   though the force, which is along z, drives none of them. */
TEST(large_deflection_takes_the_modes_that_it_drives)
{
#if FB_WITH_LARGE_DEFLECTION
  const double bend = 0.1, s = 3.0, f = 2.0;
  int taken = 0;
  boom_under_a_force(bend * 3.0 * 500.0 / 9.0, 1, 3);
  envelope.spin[2] = (fb_real)s;
  envelope.frequency = (fb_real)f;
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_OK);
  for (int a = 0, along_y = 0; a < 4; a++) {
    const int is_y = fabs((double)shape.node[1].psi[3 * a + 1]) > fabs((double)shape.node[1].psi[3 * a + 2]);
    const double delta = (double)work.deflection, omega2 = (double)shape.K[5 * a];
    along_y += is_y;
    if (is_y) { /* at 45 degrees of phase; within what shapes of u u' weigh */
      const double part = 2.0 * s * 1.2 * 0.5 * delta * f / 3.0 / omega2;
      FBT_TRUE((double)work.beside[a] > 0.3 * part && (double)work.beside[a] < 3.0 * part);
      for (int k = 0; k < advice.n; k++) {
        taken |= advice.coordinate[k] == a;
      }
    }
    FBT_TRUE(a < 3 || along_y == 1);
  }
  FBT_INT_EQ(advice.effects, FB_EFFECTS_LARGE);
  FBT_TRUE(taken);
#endif
}

/* E13.4: a body with lines and a mode in which no beam bends keeps the error of the field by what that mode gives. */
TEST(modes_beside_lines_keep_the_error_of_the_field)
{
#if FB_WITH_LARGE_DEFLECTION
  static fb_modes modes;
  static fb_beam_desc desc;
  static fb_beam beam;
  static fb_shape boom;
  const fb_real at[3] = {0, 0, FB_R(0.1)}, inertia[6] = {0}, theta[9] = {0};
  fb_real psi[9] = {0};
  double aside, all = 0.0;
  int node;
  boom_under_a_force(0.2 * 3.0 * 500.0 / 9.0, 0, 2);
  make_boom(&boom, &modes, 0, 2);
  desc.length = FB_R(3.0);
  desc.n_element = 6;
  desc.n_station = 1;
  desc.station[0].mass = FB_R(2.0);
  desc.station[0].EI_y = FB_R(500.0);
  desc.station[0].EI_z = FB_R(900.0);
  psi[8] = FB_R(1.0); /* a kilogram on a spring, as slow as the boom, moves the output, too */
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, 3), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_lump(&shape, FB_R(1.0), at, inertia, psi, theta), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, desc.length), FB_OK);
  shape.node[node].psi[8] = FB_R(1.0);
  shape.K[8] = shape.K[0];
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.09)), FB_OK);
  for (int a = 0; a < 3; a++) {
    all += (double)work.give[a];
  }
  aside = (double)work.give[2] / all;
  FBT_TRUE(aside > 0.1 && aside < 0.9);
  FBT_INT_EQ(advice.effects, FB_EFFECTS_LARGE);
  FBT_NEAR_REL(advice.error_model, aside * (double)advice.error_field, FBT_TOL(1e-9, 1e-4));
#endif
}

/* E13.3: an acceleration a along the boom is m a L^3/(7.837 EI) of what buckles it, or the same stiffer, and by that
   part is off what leaves the acceleration's stiffening out. */
TEST(accelerations_stiffen_and_soften)
{
  for (int way = -1; way <= 1; way += 2) {
    boom_under_a_force(1e-3, 0, 3);
    envelope.acceleration[0] = FB_R(0.5) * (fb_real)way;
    (void)deflection();
    FBT_NEAR_REL(advice.without[4], 2.0 * 0.5 * 27.0 / (7.837 * 500.0), 0.05);
    FBT_INT_EQ((advice.effects & FB_EFFECT_ACCELERATION_STIFFENING) != 0, 0);
    envelope.acceleration[0] *= FB_R(10.0);
    (void)deflection();
    FBT_INT_EQ((advice.effects & FB_EFFECT_ACCELERATION_STIFFENING) != 0, 1);
  }
}

/* E13.1: a uniform gravity, however strong, does nothing to a body that flies, but to one that lacks an
   effect. */
TEST(gravity_is_nothing_to_a_free_body)
{
  const fb_real center[3] = {0, 0, 0}, inertia[6] = {1, 1, 1, 0, 0, 0};
  fb_advice weak;
  boom_under_a_force(0.5, 1, 3);
  envelope.spin[0] = FB_R(1.0);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(20.0), center, inertia), FB_OK);
  level.base = FB_BASE_FREE;
  envelope.spin[2] = FB_R(0.5);
  (void)deflection();
  envelope.frequency = FB_R(2.0);
  (void)deflection();
  weak = advice;
  for (int k = 1; k <= 4; k += 3) {
    const int same = k > 1;
    envelope.acceleration[0] = envelope.acceleration[2] = FB_R(1000.0) * (fb_real)k;
    FBT_NEAR_REL(deflection(), weak.deflection, FBT_TOL(1e-6, 1e-2));
    FBT_INT_EQ(advice.effects, FB_EFFECTS_FULL);
    FBT_TRUE(!same ||
             (advice.integrator == weak.integrator && fabs((double)(advice.dt / weak.dt) - 1.0) < FBT_TOL(1e-6, 1e-2)));
    weak = advice;
  }
}

/* E8.7: the damping of a mode that is not chosen matters to no step. */
TEST(damping_goes_with_its_mode)
{
  fb_real dt, cost;
  boom_under_a_force(0.0, 1, 1);
  envelope.load[0].force[1] = FB_R(0.5);
  envelope.spin[2] = FB_R(3.0); /* keeps the implicit integrators, which bear any damping, from long steps */
  envelope.duration = FB_R(50.0);
  level.effects |= (unsigned)FB_EFFECT_DAMPING;
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.1)), FB_OK);
  FBT_INT_EQ(advice.n, 1);
  FBT_INT_EQ(advice.coordinate[0], 1);
  dt = advice.dt;
  cost = advice.cost;
  level.zeta[0] = FB_R(1e4);
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.1)), FB_OK);
  FBT_NEAR_REL(advice.dt, dt, 1e-6);
  FBT_NEAR_REL(advice.cost, cost, 1e-6);
  FBT_INT_EQ(advice.n, 1);
  level.zeta[1] = FB_R(1e4); /* but of the one that is */
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.1)), FB_OK);
  FBT_TRUE(advice.cost > FB_R(1.01) * cost || advice.dt < FB_R(0.99) * dt);
  FBT_TRUE(advice.dt > FB_R(0.01) && advice.integrator != FB_INTEGRATOR_RK4); /* what bears it is cheapest */
}

/* E13.4: a load a hundred times what the limit of the deflection lets through bends the boom as far, but what no modal
   body has grows with its square and what modes leave out stays the same part of a linear answer. */
TEST(advice_does_not_hide_what_is_out_of_range)
{
  fb_real modes[3], model;
  boom_under_a_force(0.5 * 0.5 * 3.0 * 500.0 / 9.0, 0, 3);
  shape.lines_status = FB_ERR_UNSUPPORTED;
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.1)), FB_OK);
  memcpy(modes, work.error_modes, sizeof modes);
  model = advice.error_model;
  envelope.load[0].force[2] *= FB_R(100.0);
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.1)), FB_OK);
  FBT_BELOW(advice.deflection, 1.1 * 0.5 * 3.0);
  FBT_NEAR_REL(advice.error_model, 1e4 * (double)model, 0.1); /* the tip comes in, too */
  FBT_NEAR_REL(work.error_modes[0], modes[0], 0.1);
  FBT_NEAR_REL(work.error_modes[1], modes[1], 0.1);
  FBT_TRUE(modes[0] > modes[1] && modes[1] > FB_R(0.0));
  FBT_TRUE(advice.error > FB_R(1.0));
  boom_under_a_force(500.0, 0, 1); /* the tip goes as far as it may */
  level.deflection_limit = FB_R(0.3);
  FBT_NEAR_REL(deflection(), 0.3, 0.02);
}

/* E13.1, E13.3: the same scene in other units of length, mass and time has the same advice, in them: drives
   faster and slower than a mode, a frame, damping, a spin and its rate. */
TEST(advice_knows_no_units)
{
  static const double unit[5][3] = {
      {1, 1, 1}, {64, 1, 1}, {1, 4096, 1}, {1, 1, 1024}, {1.0 / 64, 1.0 / 4096, 1.0 / 1024}};
  for (int drive = 0; drive < 4; drive++) {
    fb_advice first;
    for (int k = 0; k < 5; k++) {
      metre = (fb_real)unit[k][0];
      kilogram = (fb_real)unit[k][1];
      second = (fb_real)unit[k][2];
      boom_under_a_force(0.5 * unit[k][1] * unit[k][0] / (unit[k][2] * unit[k][2]), 1, 2);
      envelope.duration *= second;
      envelope.frequency = (drive % 2 ? FB_R(20.0) : FB_R(0.5)) / second;
      envelope.spin[drive / 2] = FB_R(0.5) / second;
      envelope.spin_rate[drive / 2] = FB_R(0.1) / (second * second);
      envelope.acceleration[2] = FB_R(0.2) * metre / (second * second);
      envelope.frame = drive == 3 ? FB_R(0.125) * second : FB_R(0.0);
      level.effects |= drive == 2 ? (unsigned)FB_EFFECT_DAMPING : 0u;
      level.zeta[0] = drive == 2 ? FB_R(0.01) : FB_R(0.0);
      FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_OK);
      first = k == 0 ? advice : first;
      FBT_NEAR_REL(advice.dt / second, first.dt, FBT_TOL(1e-5, 3e-2));
      FBT_NEAR_REL(advice.deflection / metre, first.deflection, FBT_TOL(1e-6, 1e-2));
      FBT_NEAR_REL(advice.error_model, first.error_model, FBT_TOL(1e-6, 3e-2));
      FBT_NEAR_ABS(advice.error_modes, first.error_modes, FBT_TOL(1e-6, 3e-5));
      FBT_NEAR_ABS(advice.error_effects, first.error_effects, FBT_TOL(1e-6, 3e-5));
      FBT_INT_EQ(advice.effects, first.effects);
      FBT_INT_EQ(advice.integrator, first.integrator);
      FBT_INT_EQ(advice.n, first.n);
    }
  }
  metre = kilogram = second = FB_R(1.0);
}

/* E13.1, E13.3: a base that moves at v and spins feels w x v. Every set knows it from v as from an acceleration:
   momenta are relative to the base (E11.31). */
TEST(velocities_of_a_spinning_base_are_loads)
{
  double felt, linear;
  boom_under_a_force(0.0, 0, 3);
  envelope.spin[1] = FB_R(2.0);
  envelope.acceleration[2] = -FB_R(0.2); /* w x v of v = 0.1 m/s along the boom */
  felt = deflection();
  linear = (double)work.error[0];
  envelope.velocity[0] = FB_R(0.1);
  FBT_NEAR_REL(deflection(), felt, FBT_TOL(1e-9, 1e-3));
  FBT_BELOW(linear, 0.5);
  FBT_BELOW((double)work.error[0], 0.5);
}

/* E13.3: a spin askew bends the boom by a product of its components, which reaches some sets through modes that are not
   driven: what is advised has the steady state that all modes and effects have. */
TEST(advice_counts_loads_through_other_modes)
{
  static fb_analyse_work analyse;
  double z[2];
  boom_under_a_force(0.0, 3, 3);
  envelope.spin[0] = FB_R(0.2);
  envelope.spin[2] = -FB_R(4.0);
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_OK);
  FBT_INT_EQ(fb_shape_select(&other, &shape, advice.coordinate, advice.n), FB_OK);
  for (int run = 0; run < 2; run++) {
    fb_body_desc desc = level;
    fb_state state;
    fb_input input;
    fb_motion motion;
    fb_node_motion tip;
    memset(&input, 0, sizeof input);
    memcpy(input.w, envelope.spin, sizeof input.w);
    desc.effects = run ? level.effects : advice.effects;
    FBT_INT_EQ(fb_body_init(&body, &body_work, run ? &shape : &other, &desc), FB_OK);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_body_trim(&body, &state, &analyse, &input), FB_OK);
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &input), FB_OK);
    FBT_INT_EQ(fb_body_node_motion_eval(&body, &tip, &state, &motion, 1), FB_OK);
    z[run] = (double)tip.displacement[2];
  }
  FBT_TRUE(fabs(z[1]) > 1e-3);
  FBT_NEAR_REL(z[0], z[1], 0.02);
}

SUITE(advise_formulas, RUN(selection_takes_rows_and_pairs), RUN(selected_modes_move_as_a_body_of_their_own),
      RUN(selection_refuses_nonsense), RUN(advice_estimates_the_deflection), RUN(modes_err_by_what_gives_way),
      RUN(sets_err_by_the_change_of_frequency), RUN(sets_err_as_long_as_something_acts),
      RUN(advice_knows_where_modes_end), RUN(what_acts_adds_up_at_its_worst),
      RUN(compressed_booms_bend_until_they_buckle), RUN(sets_err_by_what_they_lack), RUN(model_error_is_its_formula),
      RUN(modes_answer_as_oscillators), RUN(a_rate_too_small_to_matter_changes_no_advice), RUN(advice_knows_no_axes),
      RUN_LONG(advice_takes_as_many_modes_as_there_can_be), RUN(modes_are_taken_by_what_they_give),
      RUN(velocities_are_those_of_a_prescribed_base), RUN(bending_and_speed_have_their_phases),
      RUN(large_deflection_has_no_error_of_the_field), RUN(modes_beside_lines_keep_the_error_of_the_field),
      RUN(large_deflection_takes_the_modes_that_it_drives), RUN(accelerations_stiffen_and_soften),
      RUN(inertia_of_modes_is_less_by_the_recoil), RUN(two_booms_move_as_their_sum_and_difference),
      RUN(velocities_of_a_spinning_base_are_loads), RUN(advice_counts_loads_through_other_modes),
      RUN(gravity_is_nothing_to_a_free_body), RUN(damping_goes_with_its_mode),
      RUN(advice_does_not_hide_what_is_out_of_range), RUN(advice_knows_no_units))
