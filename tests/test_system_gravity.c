/* >>system: bodies on joints in the gravity of a center: as bodies alone, as one body, what is conserved. */
#include "system.h"

static fb_body alone;
static fb_state flown;
static fb_rk4_work rk4;

/* As fb_body_init makes it of mu and center. */
static void attract(int n_model, double mu)
{
  for (int k = 0; k < n_model; k++) {
    model[k].effects |= FB_EFFECT_CENTRAL_GRAVITY;
    model[k].mu = (fb_real)mu;
    model[k].center[0] = -FB_R(9.0);
    model[k].center[1] = FB_R(12.0);
    FBT_INT_EQ(fb_body_check(&model[k]), FB_OK);
  }
}

#if FB_WITH_LARGE_DEFLECTION
/* Loads along lines that tell where the points are and how they move. */
static fb_status drag(fb_line_point *point, int n, fb_real t, void *user)
{
  for (int k = 0; k < n; k++) {
    for (int i = 0; i < 3; i++) {
      point[k].force[i] = -FB_R(0.2) * point[k].velocity[i] + FB_R(0.05) * point[k].position[i];
    }
  }
  (void)t, (void)user;
  return FB_OK;
}
#endif

/* E8.37: a system of one free body moves as the body alone, whose frame falls with it; with distributed loads, too. */
TEST(a_center_pulls_a_system_of_one_as_its_body)
{
  static const unsigned set[] = {FB_EFFECTS_FULL, FB_EFFECTS_LARGE};
  for (int k = 0; k < (FB_SINGLE ? 0 : FB_WITH_LARGE_DEFLECTION ? 2 : 1); k++) {
    const fb_real v[3] = {FB_R(1.0), FB_R(2.0), -FB_R(1.5)}, w[3] = {FB_R(0.7), -FB_R(0.4), FB_R(0.3)};
    double worst = 0.0;
    fb_input own;
    fresh();
    memset(&own, 0, sizeof own);
#if FB_WITH_LARGE_DEFLECTION
    input.distributed = own.distributed = k ? drag : NULL;
#endif
    flexible(&model[0], 2, 1, 1, set[k]);
    attract(1, 800.0);
    alone = model[0];
    alone.base = FB_BASE_FREE;
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    FBT_INT_EQ(fb_state_init(&alone, &flown), FB_OK);
    turn(start[0].quat, 0.3, 0.2, -0.4);
    memcpy(flown.quat, start[0].quat, sizeof flown.quat);
    for (int i = 0; i < 3; i++) {
      start[0].value[i] = flown.rho[i] = (fb_real)(0.5 + i);
      start[0].speed[i] = v[i];
      start[0].speed[3 + i] = w[i];
    }
    for (int a = 0; a < alone.n; a++) {
      start[0].q[a] = flown.q[a] = (fb_real)(0.05 - 0.02 * a);
    }
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_state_from_velocity(&alone, &flown, v, w, NULL), FB_OK);
    for (int i = 0; i < 400; i++) {
      FBT_INT_EQ(fb_rk4_step(&alone, &flown, &rk4, &own, &own, &own, FB_R(0.002)), FB_OK);
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(0.002)), FB_OK);
    }
    worst = fmax(fbt_difference(flown.rho, state.link[0].x, 3), fbt_difference(flown.quat, state.link[0].quat, 4));
    worst = fmax(worst, fbt_difference(flown.q, state.link[0].q, alone.n));
    FBT_BELOW(worst, 1e-7);
  }
}

/* E8.37, E9.15: energy, and angular momentum about the center; by either method, with joints as loops, with lines. */
TEST(systems_about_a_center_keep_energy_and_momentum)
{
  static const unsigned set[] = {FB_EFFECTS_FULL, FB_EFFECTS_LARGE};
  for (int k = 0; k < (FB_SINGLE ? 0 : FB_WITH_LARGE_DEFLECTION ? 2 : 1); k++) {
    for (int form = 0; form < (k ? 1 : (int)FORMS); form++) {
      fb_momentum momentum[2];
      double E[2], L[2][3], size = 0.0;
      tree(set[k], 0);
      attract(3, 2000.0);
      init(form);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
      for (int j = 0; j < 2; j++) {
        const fb_real *const c = model[0].center;
        E[j] = energy_of(&state);
        FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &momentum[j], &state, &input), FB_OK);
        for (int i = 0; i < 3; i++) {
          const int a = (i + 1) % 3, b = (i + 2) % 3;
          L[j][i] =
              (double)momentum[j].angular[i] - (double)(c[a] * momentum[j].linear[b] - c[b] * momentum[j].linear[a]);
          size = fmax(size, fabs(L[j][i]));
        }
        for (int i = 0; i < 300 && j == 0; i++) {
          FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(0.001)), FB_OK);
        }
      }
      FBT_NEAR_REL(E[1], E[0], 1e-8);
      for (int i = 0; i < 3; i++) {
        FBT_NEAR_ABS(L[1][i], L[0][i], 1e-8 * size);
      }
      FBT_TRUE(fabs((double)(momentum[1].linear[1] - momentum[0].linear[1])) > 1.0);
    }
  }
}

/* E8.36: two bodies that a rigid joint makes one turn as that one, but for the next degree of each, by size/distance. */
TEST(two_bodies_about_a_center_turn_as_one)
{
  double off[2] = {0.0, 0.0};
  for (int far = 0; far < (FB_SINGLE ? 0 : 2); far++) {
    const fb_real x = far ? FB_R(191.0) : FB_R(91.0); /* [m] 200 and 100 from the center */
    fb_real w_dot[2][3];
    for (int one = 0; one < 2; one++) {
      fresh();
      rigid(&model[0], 3.0, 0.0, 0.0, 0.0, 0.3, 0.4, 0.5);
      rigid(&model[1], 2.0, 0.0, 0.0, 0.0, 0.2, 0.1, 0.3);
      if (one) { /* of both, 2 kg at (1, 1, 0): mass center, inertia about it */
        const fb_real center[3] = {FB_R(0.4), FB_R(0.4), 0};
        const fb_real inertia[6] = {FB_R(1.7), FB_R(1.7), FB_R(3.2), -FB_R(1.2), 0, 0};
        FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
        FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(5.0), center, inertia), FB_OK);
        FBT_INT_EQ(fb_body_init(&model[0], &body_work, &shape, &body_desc), FB_OK);
      }
      hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
      start[0].value[0] = x;
      start[0].value[1] = FB_R(12.0);
      if (!one) {
        hang(1, 1, FB_JOINT_RIGID, 0, 0);
        desc.joint[1].position[0] = desc.joint[1].position[1] = FB_R(1.0);
      }
      attract(one ? 1 : 2, 1e6);
      init(FB_METHOD_RECURSIVE);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
      memcpy(w_dot[one], motion.motion[0].w_dot, sizeof w_dot[one]);
    }
    off[far] = fbt_difference(w_dot[0], w_dot[1], 3) / fbt_largest(w_dot[1], 3);
    FBT_BELOW(off[far], far ? 0.02 : 0.04);
  }
  FBT_TRUE(FB_SINGLE || fabs(off[0] / off[1] - 2.0) < 0.2);
}

/* E8.36: refusals: the center inside a body; in single precision; linear models. */
TEST(systems_refuse_centers_they_do_not_know)
{
  static fb_system_analyse_work analyse;
  static fb_spectrum spectrum;
  fb_system_state kept;
  fresh();
  rigid(&model[0], 3.0, 0.0, 0.0, 0.0, 3.0, 4.0, 5.0);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  attract(1, 100.0);
#if FB_SINGLE
  FBT_INT_EQ(fb_system_init(&mechanism, &work, model, &desc, 1), FB_ERR_UNSUPPORTED);
  (void)analyse, (void)spectrum, (void)kept;
#else
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_spectrum_solve(&mechanism, model, &analyse, &spectrum, &state, &input), FB_ERR_UNSUPPORTED);
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(0.01)), FB_OK);
  start[0].value[0] = -FB_R(9.0);
  start[0].value[1] = FB_R(13.0);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  kept = state;
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(0.01)), FB_ERR_RANGE);
  FBT_TRUE(memcmp(&kept, &state, sizeof state) == 0);
#endif
}

SUITE(system_gravity, RUN(a_center_pulls_a_system_of_one_as_its_body),
      RUN(systems_about_a_center_keep_energy_and_momentum), RUN(two_bodies_about_a_center_turn_as_one),
      RUN(systems_refuse_centers_they_do_not_know))
