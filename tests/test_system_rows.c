/* >>system: constraints of the caller's own, ranks and weights of rows. */
#include "system.h"

static fb_system_state kept;

/* Holds x of body 0; user: the earliest and the latest time asked for. */
static int times_seen(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  double *const seen = (double *)user;
  (void)pose, (void)capacity;
  seen[0] = fmin(seen[0], (double)t);
  seen[1] = fmax(seen[1], (double)t);
  row[0].body[1] = FB_GROUND;
  row[0].force[0][0] = FB_R(1.0);
  return 1;
}

/* E11.14: the caller's constraints are asked for at times within the step. */
TEST(constraints_are_asked_for_within_the_step)
{
  double seen[2] = {1e9, -1e9};
  fb_system_input end;
  fresh();
  rigid(&model[0], 2.0, 0, 0, 0, 0.5, 0.5, 0.5);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  input.rows = times_seen;
  input.user = seen;
  input.t = FB_R(8.0);
  end = input;
  end.t = FB_R(8.25);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &end, FB_R(0.25), 0), FB_OK);
  FBT_NEAR_ABS(seen[0], 8.0, FBT_TOL(1e-4, 1e-2)); /* rates by differences */
  FBT_NEAR_ABS(seen[1], 8.25, FBT_TOL(1e-4, 1e-2));
}

/* A thin disc of radius 0.5 m on the plane z = 0: no slip along x and y, no height under the rim. */
static int disc_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  const double r = *(const double *)user;
  const double e[3] = {(double)pose->R[2], (double)pose->R[5], (double)pose->R[8]}, s = sqrt(1.0 - e[2] * e[2]);
  const fb_real arm[3] = {(fb_real)(r * e[2] * e[0] / s), (fb_real)(r * e[2] * e[1] / s), (fb_real)(-r * s)};
  FBT_TRUE(capacity >= 3);
  (void)t;
  for (int i = 0; i < 3; i++) {
    row[i].body[1] = FB_GROUND;
    row[i].force[0][i] = FB_R(1.0);
    fb_vec3_cross(row[i].torque[0], arm, row[i].force[0]);
    row[i].holonomic = i == 2;
    row[i].value = i == 2 ? pose->position[2] + arm[2] : 0;
  }
  return 3;
}

/* E9.10, E9.13, the caller's rows: a disc rolls round in a circle at constant tilt when W w3 sin(a) (C + m r^2) - A W^2
   sin(a) cos(a) + m g r cos(a) = 0, W its rate about the vertical, w3 about its axis, at a from the vertical
   (Newton-Euler about the contact point). */
TEST(a_disc_rolls_steadily)
{
  double r = 0.5;
  const double m = 2.0, tilt = 1.2, W = 1.7, A = 0.25 * m * r * r, C = 2.0 * A, g = 9.81;
  const double w3 = (A * W * W * sin(tilt) - m * g * r) * cos(tilt) / (W * sin(tilt) * (C + m * r * r));
  const double n = w3 - W * cos(tilt), spin[3] = {n * sin(tilt), 0, W + n * cos(tilt)};
  const double up[3] = {-r * cos(tilt), 0, r * sin(tilt)};
  const double v[3] = {spin[1] * up[2] - spin[2] * up[1], spin[2] * up[0] - spin[0] * up[2],
                       spin[0] * up[1] - spin[1] * up[0]};
  double before, worst = 0.0;
  fb_real R[9], vi[3], wi[3];
  fresh();
  body_desc.effects = FB_EFFECT_GRAVITY;
  body_desc.gravity[2] = -(fb_real)g;
  rigid(&model[0], m, 0, 0, 0, A, A, C);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  start[0].value[2] = (fb_real)(r * sin(tilt));
  turn(start[0].quat, 0, tilt, 0);
  fb_quat_to_mat33(R, start[0].quat);
  for (int i = 0; i < 3; i++) {
    vi[i] = (fb_real)v[i];
    wi[i] = (fb_real)spin[i];
  }
  fb_mat33_mulT_vec3(start[0].speed, R, vi);
  fb_mat33_mulT_vec3(start[0].speed + 3, R, wi);
  input.rows = disc_rows;
  input.user = &r;
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  before = energy_of(&state);
  for (int k = 0; k < 2000; k++) {
    const fb_real *q = state.link[0].quat;
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(0.002)), FB_OK);
    worst = fmax(worst, fabs((double)(FB_R(1.0) - 2 * (q[1] * q[1] + q[2] * q[2])) - cos(tilt)));
  }
  FBT_BELOW(worst, FBT_TOL(1e-7, 1e-3));
  FBT_NEAR_REL(energy_of(&state), before, FBT_TOL(1e-9, 1e-3));
  fbt_figure("rolling disc, cosine of its tilt over 4 s", "steady rolling, closed form", worst);
}

/* No velocity across the x axis of user's body. */
static int knife_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  const int body = *(const int *)user;
  (void)capacity, (void)t;
  row->body[0] = body;
  row->body[1] = FB_GROUND;
  for (int i = 0; i < 3; i++) {
    row->force[0][i] = pose[body].R[3 * i + 1];
  }
  return 1;
}

/* E9.10, E9.4: a knife edge on a slope, on two massless slides and a hinge or on nothing: heading w t, x = g/(2 w^2)
   sin^2 w t, y = g/(2 w^2) (w t - sin(2 w t)/2), it does not slide down; slowly or a thousand times as fast. */
TEST(a_knife_edge_draws_a_cycloid)
{
  for (int run = 0; run < 4; run++) {
    const double hertz = run % 2 ? 1e3 : 1.0, g = 3.0 * hertz * hertz, w = 2.0 * hertz, dt = 0.002 / hertz;
    int knife = run / 2 ? 0 : 2;
    fresh();
    body_desc.base = FB_BASE_PRESCRIBED;
    rigid(&model[0], 0, 0, 0, 0, 0, 0, 0);
    rigid(&model[1], 1.5, 0, 0, 0, 0.1, 0.1, 0.2);
    if (knife == 0) {
      hang(0, 1, FB_JOINT_FREE, FB_GROUND, 0);
    } else {
      hang(0, 0, FB_JOINT_PRISMATIC, FB_GROUND, 0);
      hang(1, 0, FB_JOINT_PRISMATIC, 0, 0);
      hang(2, 1, FB_JOINT_REVOLUTE, 1, 0);
      turn(desc.joint[0].attitude, 0, pi / 2, 0);
      turn(desc.joint[0].child_attitude, 0, pi / 2, 0);
      turn(desc.joint[1].attitude, -pi / 2, 0, 0);
      turn(desc.joint[1].child_attitude, -pi / 2, 0, 0);
    }
    start[knife].speed[knife ? 0 : 5] = (fb_real)w;
    input.rows = knife_rows;
    input.user = &knife;
    input.n_load = 1;
    input.load[0].body = knife;
    input.load[0].load.force[0] = (fb_real)(1.5 * g);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    for (int k = 1; k <= 1000; k++) {
      const double t = dt * k;
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, (fb_real)dt), FB_OK);
      FBT_NEAR_ABS(state.link[0].x[0], g / (2 * w * w) * sin(w * t) * sin(w * t), FBT_TOL(1e-9, 1e-4));
      FBT_NEAR_ABS(knife ? state.link[1].x[0] : state.link[0].x[1], g / (2 * w * w) * (w * t - 0.5 * sin(2 * w * t)),
                   FBT_TOL(1e-9, 1e-4));
    }
  }
}

/* A wire through a point that moves away from body 1 at user's first two [m/s], turning at the third [rad/s]: body 0
   slides on it. About z it turns relative to the other at 0.5 + 0.8 t. */
static int wire_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  const double *const to = (const double *)user;
  const double time = (double)t, angle = to[2] * time, along[2] = {cos(angle), sin(angle)};
  const double across[2] = {-along[1], along[0]};
  FBT_TRUE(capacity >= 2);
  row[0].body[1] = row[1].body[1] = 1;
  row[0].holonomic = 1;
  for (int i = 0; i < 2; i++) {
    const double r = (double)pose[0].position[i] - (double)pose[1].position[i] - to[i] * time;
    row[0].force[0][i] = (fb_real)across[i];
    row[0].force[1][i] = -(fb_real)across[i];
    row[0].value += (fb_real)(across[i] * r);
    row[0].b -= (fb_real)(to[2] * along[i] * r + across[i] * to[i]);
  }
  for (int i = 0; i < 3; i++) { /* both turn about z */
    row[1].torque[0][i] = pose[0].R[3 * i + 2];
    row[1].torque[1][i] = -pose[1].R[3 * i + 2];
  }
  row[1].b = -(t * FB_R(0.8) + FB_R(0.5));
  return 2;
}

/* E9.10, E9.13, the caller's rows that move with time and with both bodies: on the turning wire s'' = w^2 s, s = s0
   cosh w t + s0'/w sinh w t; the center of mass goes straight on, and the spins share what is asked for. */
TEST(a_bead_is_flung_along_a_turning_wire)
{
  double to[3] = {0.2, -0.3, 3.0};
  const double w = to[2], m[2] = {2.0, 0.5}, J[2] = {0.3, 0.1}, s0 = 0.4, s0_dot = -0.5, T = 0.2;
  const double cm_rate[3] = {0.1, 0.7, -0.2}, z_rate = 0.6;
  const double first_rate[3] = {to[0] + s0_dot, to[1] + w * s0, z_rate}; /* body 0 relative to body 1 */
  fresh();
  for (int k = 0; k < 2; k++) {
    const double part = k == 0 ? m[1] / (m[0] + m[1]) : -m[0] / (m[0] + m[1]);
    rigid(&model[k], m[k], 0, 0, 0, J[k], J[k], J[k]);
    hang(k, k, FB_JOINT_FREE, FB_GROUND, 0);
    start[k].value[0] = (fb_real)(part * s0);
    for (int i = 0; i < 3; i++) {
      start[k].speed[i] = (fb_real)(cm_rate[i] + part * first_rate[i]);
    }
  }
  start[0].speed[5] = FB_R(0.5);
  input.rows = wire_rows;
  input.user = to;
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  for (int k = 0; k <= 1; k++) {
    const double t = k * T, s = s0 * cosh(w * t) + s0_dot / w * sinh(w * t), c = cos(w * t), d = sin(w * t);
    const double s_dot = w * s0 * sinh(w * t) + s0_dot * cosh(w * t), spin = 0.5 + 0.8 * t;
    const double r[3] = {to[0] * t + s * c, to[1] * t + s * d, z_rate * t};
    const double v[3] = {to[0] + s_dot * c - w * s * d, to[1] + s_dot * d + w * s * c, z_rate};
    const double a[3] = {-2.0 * w * s_dot * d, 2.0 * w * s_dot * c, 0.0};
    const int n = FBT_TOL(200, 50);
    for (int step = 0; step < n && k == 1; step++) {
      fb_system_input middle = input, end = input;
      middle.t = (fb_real)((step + 0.5) * T / n);
      end.t = (fb_real)((step + 1) * T / n);
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &middle, &end, (fb_real)(T / n)), FB_OK);
      input = end;
    }
    memset(&work, 0xff, sizeof work); /* what is in it means nothing */
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    for (int body = 0; body < 2; body++) {
      const double part = body == 0 ? m[1] / (m[0] + m[1]) : -m[0] / (m[0] + m[1]);
      const double turns = body == 0 ? J[1] / (J[0] + J[1]) : -J[0] / (J[0] + J[1]);
      const double carried = J[0] * 0.5 / (J[0] + J[1]); /* of the spin that there was */
      fb_node_motion at;
      FBT_INT_EQ(fb_body_node_motion_eval(&model[body], &at, &motion.pose[body], &motion.motion[body], 0), FB_OK);
      for (int i = 0; i < 3; i++) {
        FBT_NEAR_ABS(at.position[i], cm_rate[i] * t + part * r[i], FBT_TOL(1e-9, 1e-4));
        FBT_NEAR_ABS(at.velocity[i], cm_rate[i] + part * v[i], FBT_TOL(1e-8, 1e-3));
        FBT_NEAR_ABS(at.acceleration[i], part * a[i], FBT_TOL(1e-7, 1e-2));
      }
      FBT_NEAR_ABS(motion.motion[body].w[2], carried + turns * spin, FBT_TOL(1e-9, 1e-4));
      FBT_NEAR_ABS(motion.motion[body].w_dot[2], turns * 0.8, FBT_TOL(1e-9, 1e-3));
    }
  }
}

/* Holds node 1 of each of two bodies along the body's x axis, turned about z by user's [rad]. */
static int radial_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  const fb_real aside = *(const fb_real *)user;
  (void)capacity, (void)t;
  for (int k = 0; k < 2; k++) {
    row[k].body[0] = k;
    row[k].body[1] = FB_GROUND;
    row[k].node[0] = 1;
    for (int i = 0; i < 3; i++) {
      row[k].force[0][i] = pose[k].R[3 * i] + aside * pose[k].R[3 * i + 1];
    }
  }
  return 2;
}

/* E9.9: rows along which nothing can move, the tips of pendulums along their rods, are left out: what is left of them
   is rounding, and the pendulums swing as without them. 1e-10 rad aside (1e-5 in single precision) they count. */
TEST(rows_along_which_nothing_moves_are_left_out)
{
  fb_real aside = FB_R(0.0);
  fresh();
  body_desc.effects = FB_EFFECT_GRAVITY;
  body_desc.gravity[1] = -FB_R(9.81);
  rigid(&model[0], 1.0, 0.5, 0, 0, 0.01, 1.0 / 12.0, 1.0 / 12.0);
  for (int k = 0; k < 2; k++) {
    hang(k, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    turn(desc.joint[k].attitude, 0.3, -0.5, 0.7); /* no component is exact */
    start[k].speed[0] = (fb_real)(1 + k);
  }
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &kept, &work, start, NULL), FB_OK);
  input.rows = radial_rows;
  input.user = &aside;
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  for (int step = 0; step < 200; step++) {
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &kept, &work, NULL, NULL, NULL, FB_R(0.005)), FB_OK);
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(0.005)), FB_OK);
    FBT_INT_EQ(work.rank, 0);
  }
  for (int k = 0; k < 2; k++) {
    FBT_NEAR_ABS(state.link[k].x[0], kept.link[k].x[0], FBT_TOL(1e-13, 1e-5));
  }
  for (int counts = 0; counts < 2; counts++) {
    fresh(); /* without rounding: axes of the ground, the rod along x */
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    hang(1, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    aside = (fb_real)((counts ? 1.5 : 0.7) * FBT_TOL(1e-10, 1e-5));
    input.rows = radial_rows;
    input.user = &aside;
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, NULL, &input), FB_OK);
    FBT_INT_EQ(work.rank, counts ? 2 : 0);
  }
}

typedef struct sharp_pair {
  double angle, size[2]; /* [rad] between two directions, how long each is */
} sharp_pair;

static int sharp_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  const sharp_pair *const pair = (const sharp_pair *)user;
  (void)capacity, (void)t, (void)pose;
  row[0].body[1] = row[1].body[1] = FB_GROUND;
  row[0].force[0][0] = (fb_real)pair->size[0];
  row[1].force[0][0] = (fb_real)(pair->size[1] * cos(pair->angle));
  row[1].force[0][1] = (fb_real)(pair->size[1] * sin(pair->angle));
  return 2;
}

/* E9.9: a row is weighed with those of its kind at the same joint: at a ten-thousandth of a radian (a hundredth in
   single precision) two directions are one, five times that if one is five times as long, the first or the second; a
   heavy and a light body each have what holds them, and so have force and torque of a body whose inertia is next to
   nothing beside its mass. */
TEST(rows_are_weighed_with_their_kind)
{
  for (int run = 0; run < 6; run++) {
    const int counts = run % 2, longer = run / 2;
    sharp_pair pair = {sqrt((counts ? 1.5 : 0.7) * FBT_TOL(1e-8, 1e-4)), {1.0, 1.0}};
    if (longer > 0) {
      pair.angle *= 5.0;
      pair.size[longer - 1] = 5.0;
    }
    fresh();
    rigid(&model[0], 2.0, 0, 0, 0, 0.1, 0.1, 0.1);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    input.rows = sharp_rows;
    input.user = &pair;
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, NULL, &input), FB_OK);
    FBT_INT_EQ(work.rank, 1 + counts);
  }
  fresh();
  rigid(&model[0], 1e5, 0, 0, 0, 1e-5, 1e-5, 1e-5);
  rigid(&model[1], 1e-5, 0, 0, 0, 1e5, 1e5, 1e5);
  for (int k = 0; k < 2; k++) {
    hang(k, k, FB_JOINT_FREE, FB_GROUND, 0);
    close_loop(FB_JOINT_RIGID, FB_GROUND, 0, k, 0);
    start[k].speed[0] = start[k].speed[4] = FB_R(1.0);
  }
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
  FBT_INT_EQ(work.rank, 12);
  for (int k = 0; k < 2; k++) {
    for (int i = 0; i < 6; i++) { /* of the mass or the inertia times the speed that it had */
      FBT_NEAR_ABS(state.link[k].p[i], 0.0, FBT_TOL(1e-13, 1e-5) * ((i < 3) == (k == 0) ? 1e5 : 1e-5));
    }
  }
  for (int held = 0; held < 2; held++) { /* one by a loop, the other by the caller */
    sharp_pair across = {0.5 * pi, {1.0, 1.0}};
    fresh();
    hang(0, !held, FB_JOINT_FREE, FB_GROUND, 0);
    hang(1, held, FB_JOINT_FREE, FB_GROUND, 0);
    close_loop(FB_JOINT_RIGID, FB_GROUND, 0, 1, 0);
    input.rows = sharp_rows;
    input.user = &across;
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, NULL, &input), FB_OK);
    FBT_INT_EQ(work.rank, 8);
  }
}

typedef struct unlike_rows {
  double size; /* of both */
  int force;   /* row that is a force; the other one is a torque */
} unlike_rows;

static int force_and_torque_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  const unlike_rows *const unlike = (const unlike_rows *)user;
  (void)capacity, (void)t, (void)pose;
  for (int k = 0; k < 2; k++) { /* along x, about y; of one the ground is the first body, of the other the second */
    fb_row *at = &row[k];
    at->body[k] = FB_GROUND;
    (k == unlike->force ? &at->force[1 - k][0] : &at->torque[1 - k][1])[0] = (fb_real)unlike->size;
  }
  return 2;
}

/* E9.9: force and torque on one body, next to nothing of inertia beside its mass or the other way round, both hold it,
   whichever comes first and however long they are. */
TEST(force_and_torque_are_weighed_apart)
{
  for (int run = 0; run < 12; run++) {
    const double heavy = run % 2 ? 1e4 : 1e-4;
    unlike_rows unlike = {pow(1e-2, run / 4), run / 2 % 2};
    fresh();
    rigid(&model[0], heavy, 0, 0, 0, 1.0 / heavy, 1.0 / heavy, 1.0 / heavy);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    start[0].speed[0] = start[0].speed[4] = FB_R(1.0);
    input.rows = force_and_torque_rows;
    input.user = &unlike;
    init(FB_METHOD_RECURSIVE);
    memset(&work, 0xff, sizeof work); /* what is in it means nothing */
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(work.rank, 2);
    FBT_NEAR_ABS(fbt_largest(state.link[0].p, 6), 0.0, FBT_TOL(1e-10, 1e-2));
  }
}

/* Moves a body along x at 1 m/s, and at user's more [m/s]. */
static int disagreeing_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  (void)capacity, (void)pose, (void)t;
  row[0].body[1] = row[1].body[1] = FB_GROUND;
  row[0].force[0][0] = row[1].force[0][0] = FB_R(1.0);
  row[0].b = -FB_R(1.0);
  row[1].b = -FB_R(1.0) - *(const fb_real *)user;
  return 2;
}

/* E9.10: rows may contradict each other by thousands of roundings of the speed, not by a millionth (a hundredth in single
   precision). */
TEST(rows_may_disagree_by_rounding)
{
  for (int run = 0; run < 4; run++) {
    const double part = run % 2 ? FBT_TOL(1e-6, 1e-2) : FBT_TOL(7e3, 70.0) * (double)FB_EPSILON;
    fb_real more = (fb_real)(run / 2 ? -part : part);
    fresh();
    rigid(&model[0], 2.0, 0, 0, 0, 1, 1, 1);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    input.rows = disagreeing_rows;
    input.user = &more;
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, NULL, &input),
               run % 2 ? FB_ERR_CONTRADICTION : FB_OK);
  }
}

typedef struct wrong_row {
  int count, row, what; /* rows, the one that is wrong, how */
} wrong_row;

/* Moves a body at (1, 2, 3) mm/s, and along x, half the same row, again. */
static int wrong_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  wrong_row *const wrong = (wrong_row *)user;
  fb_row *const at = &row[wrong->row];
  fb_real *const field[6] = {at->force[0], at->force[1], at->torque[0], at->torque[1], &at->b, &at->value};
  (void)capacity, (void)pose, (void)t;
  for (int k = 0; k < 4; k++) {
    row[k].body[1] = FB_GROUND;
    row[k].force[0][k % 3] = k < 3 ? FB_R(1.0) : FB_R(0.5);
    row[k].b = -FB_R(1e-3) * (fb_real)(k % 3 + 1) * row[k].force[0][k % 3];
  }
  if (wrong->what < 6) {
    *field[wrong->what] = (fb_real)NAN;
  } else if (wrong->what < 8) {
    at->body[wrong->what - 6] = 1;
  } else if (wrong->what < 10) {
    at->node[wrong->what - 8] = 2;
  } else if (wrong->what == 10) {
    at->b = FB_R(1e-3);
  } else if (wrong->what == 11) {
    wrong->count = 7 - wrong->count; /* 4 and 3 by turns */
  }
  return wrong->count;
}

/* E9.10, the caller's rows: what is wrong with one is said with its number, -2 - k, whichever it is: not a number, a
   body or node that there is not, against another one; and another number of rows than before. Nothing is wrong with
   one that says the same as another. */
TEST(wrong_rows_are_named)
{
  for (int what = 0; what < 13; what++) {
    for (int k = 0; k < 3; k += 2) {
      const fb_status expected = what < 6     ? FB_ERR_NOT_FINITE
                                 : what < 10  ? FB_ERR_CAPACITY
                                 : what == 10 ? FB_ERR_CONTRADICTION
                                 : what == 11 ? FB_ERR_VALUE
                                              : FB_OK;
      wrong_row wrong;
      wrong.count = 4;
      wrong.row = what == 10 ? 3 : k;
      wrong.what = what;
      fresh();
      rigid(&model[0], 1.0, 0, 0, 0, 1, 1, 1);
      hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
      input.rows = wrong_rows;
      input.user = &wrong;
      init(FB_METHOD_RECURSIVE);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, NULL, &input), expected);
      FBT_INT_EQ(work.joint, what < 11 ? -2 - wrong.row : -1);
      for (int i = 0; i < 3 && what == 12; i++) {
        FBT_NEAR_ABS(state.link[0].p[i], 1e-3 * (i + 1), FBT_TOL(1e-16, 1e-8));
      }
    }
  }
}

/* E9.4, E9.5: a body without mass between two joints of a kind, the ground or nothing on one side of it, a body on the
   other: their axes are the same ones, of a ball joint all of them, and it is refused, whichever way its axes are, what
   is left of the inertia being rounding. Where the axes differ it is carried along. */
TEST(what_moves_no_inertia_but_rounding_is_refused)
{
  static const fb_joint_kind kinds[3] = {FB_JOINT_PRISMATIC, FB_JOINT_REVOLUTE, FB_JOINT_SPHERICAL};
  fbt_seed(31);
  for (int run = 0; run < 240; run++) {
    const int kind = run % 3, axis = run / 3 % 3, held = run / 9 % 2, aside = run / 18 % 4 == 0 && held && kind < 2;
    const double angle = 2.0 * pi / 3.0 * (axis - 1) / sqrt(3.0), offset = run % 2 ? 1e3 : 0.0;
    fresh();
    rigid(&model[0], 0, 0, 0, 0, 0, 0, 0);
    rigid(&model[1], 2.0, 0, 0, 0, 10.0, 10.0, 10.0);
    for (int k = 0; k < 2; k++) {
      hang(k, k, k == 1 || held ? kinds[kind] : FB_JOINT_FREE, k - 1, 0);
    }
    turn(desc.joint[0].child_attitude, angle, angle, angle); /* z of the joint is x, y or z of the body */
    turn(desc.joint[1].attitude, angle + 0.4 * aside, angle, angle);
    turn_anyhow(desc.joint[1].child_attitude, 2.0);
    for (int i = 0; i < 3; i++) {
      (kind ? desc.joint[1].child_position : desc.joint[1].position)[i] = (fb_real)(offset * fbt_random());
    }
    FBT_INT_EQ(fb_system_init(&mechanism, &work, model, &desc, 2), aside ? FB_OK : FB_ERR_SINGULAR);
    FBT_INT_EQ(work.joint, aside ? -1 : 0);
  }
}

SUITE(system_rows, RUN(constraints_are_asked_for_within_the_step), RUN(a_bead_is_flung_along_a_turning_wire),
      RUN(rows_along_which_nothing_moves_are_left_out), RUN(rows_are_weighed_with_their_kind),
      RUN(a_knife_edge_draws_a_cycloid), RUN(wrong_rows_are_named), RUN(force_and_torque_are_weighed_apart),
      RUN(what_moves_no_inertia_but_rounding_is_refused), RUN(rows_may_disagree_by_rounding),
      RUN(a_disc_rolls_steadily))
