/* >>body and >>assemble: bodies in other coordinates, with as many of them, nodes and loads as there can be. */
#include "body.h"

static fb_shape other;

/* ---- as many coordinates, nodes and loads as there can be */

static void combine_pairs(fb_real *x, int width)
{
  combine(x, LARGE * width);
  for (int a = 0; a < LARGE; a++) {
    combine(x + a * LARGE * width, width);
  }
}

/* Random numbers of each pair of coordinates, `width` of them; symmetric. */
static void pairs_random(fb_real *x, int width, double scale)
{
  fbt_fill(x, LARGE * LARGE * width, scale);
  for (int a = 0; a < LARGE; a++) {
    for (int b = 0; b < a; b++) {
      memcpy(x + width * (a * LARGE + b), x + width * (b * LARGE + a), sizeof(fb_real) * (size_t)width);
    }
  }
}

/* Shapes, linear and quadratic, of one place. */
static void shapes_random(fb_real *psi, fb_real *chi, int combined)
{
  fbt_fill(psi, 3 * LARGE, 0.3);
  pairs_random(chi, 3, 0.05);
  if (combined) {
    combine(psi, 3);
    combine_pairs(chi, 3);
  }
}

/* Particles, a lumped body and nodes that move by all coordinates. */
static void large_shape(int combined)
{
  static const fb_real inertia[6] = {FB_R(0.5), FB_R(0.6), FB_R(0.7), FB_R(0.1), -FB_R(0.05), FB_R(0.08)};
  static fb_real chi[3 * LARGE * LARGE], turn[3 * LARGE * LARGE];
  fb_real r[3], psi[3 * LARGE], theta[3 * LARGE];
  int node = 0;
  fbt_seed(23);
  FBT_INT_EQ(fb_shape_init(&shape, LARGE), FB_OK);
  for (int k = 0; k < PARTICLES; k++) {
    fbt_fill(r, 3, 1.0);
    shapes_random(psi, chi, combined);
    FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(1.5), r, psi, chi), FB_OK);
  }
  for (int k = 1; k < FB_MAX_NODES; k++) {
    fbt_fill(r, 3, 1.0);
    shapes_random(psi, chi, combined);
    shapes_random(theta, turn, combined);
    FBT_INT_EQ(fb_shape_add_node(&shape, &node, r, psi, theta), FB_OK);
    FBT_INT_EQ(node, k);
    for (int a = 0, pair = 0; a < LARGE; a++) {
      for (int b = 0; b <= a; b++, pair += 3) {
        memcpy(shape.node[node].chi + pair, chi + 3 * (a * LARGE + b), 3 * sizeof(fb_real));
        memcpy(shape.node[node].chi_theta + pair, turn + 3 * (a * LARGE + b), 3 * sizeof(fb_real));
      }
    }
  }
  FBT_INT_EQ(fb_shape_add_node(&shape, &node, r, psi, theta), FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_shape_add_lump(&shape, FB_R(2.0), r, inertia, psi, theta), FB_OK);
  pairs_random(shape.K, 1, 0.3);
  for (int a = 0; a < LARGE; a++) {
    shape.K[a * (LARGE + 1)] = (fb_real)(9.0 + a);
  }
  if (combined) {
    combine_pairs(shape.K, 1);
  }
}

static void large_body(int form, fb_base base, unsigned damping, int combined)
{
  static fb_body_desc level;
  static fb_form_body of_form;
  const fb_form_desc kind = {(fb_form)form, FB_TORQUE_IDENTITY, NULL};
  memset(&level, 0, sizeof level);
  level.base = base;
  level.effects = (form == FBT_FIRST ? FB_EFFECTS_SPIN : FB_EFFECTS_FULL) | damping | FB_EFFECT_GRAVITY;
  level.gravity[0] = FB_R(0.3);
  level.gravity[2] = -FB_R(1.5);
  for (int a = 0; a < LARGE; a++) {
    level.zeta[a] = (fb_real)(0.01 + 0.001 * a);
  }
  large_shape(combined);
  fbt_fit(&level);
  FBT_INT_EQ(fb_form_init(&of_form, &body_work, &shape, &level, &kind), FB_OK);
  body = of_form.body;
  formed = form == FBT_MOMENTUM ? NULL : &of_form;
  FBT_INT_EQ(fb_form_check(&of_form), FB_OK);
  FBT_TRUE(fb_form_crc(&of_form) != 0);
}

/* A load on each node, in all axes. */
static void large_input(fb_input *input)
{
  memset(input, 0, sizeof *input);
  input->n_load = FB_MAX_LOADS;
  for (int k = 0; k < FB_MAX_LOADS; k++) {
    input->load[k].node = k % FB_MAX_NODES;
    input->load[k].axes = (fb_axes)(k % 3);
    fbt_fill(input->load[k].force, 3, 2.0);
    fbt_fill(input->load[k].torque, 3, 1.0);
  }
  fbt_fill(input->v, 3, 1.0);
  fbt_fill(input->w, 3, 0.5);
  fbt_fill(input->v_dot, 3, 1.0);
  fbt_fill(input->w_dot, 3, 1.0);
}

typedef struct outcome { /* all reals: what a body does, in whichever coordinates */
  fb_real limit[6], v[3], w[3], acceleration[3], w_dot[3], q_ddot[LARGE], force[3], torque[3];
  fb_energy energy;
  fb_momentum momentum;
  fb_node_motion node[FB_MAX_NODES];
} outcome;

static void large_outcome(outcome *out, int combined)
{
  fb_state state;
  fb_motion motion;
  fb_input input;
  moving_state(&state, 0.05, combined);
  large_input(&input);
  FBT_INT_EQ(fb_state_check(&body, &state), FB_OK);
  FBT_INT_EQ(BODY_EVAL(motion_eval, &motion, &state, &input), FB_OK);
  FBT_INT_EQ(BODY_EVAL(energy_eval, &out->energy, &state, &input), FB_OK);
  FBT_INT_EQ(BODY_EVAL(momentum_eval, &out->momentum, &state, &input), FB_OK);
  for (int k = 0; k < FB_MAX_NODES; k++) {
    FBT_INT_EQ(fb_body_node_motion_eval(&body, &out->node[k], &state, &motion, k), FB_OK);
  }
  if (!combined) {
    combine_state(motion.q_ddot);
  }
  for (int a = 0; a < LARGE; a++) { /* in the unit of the others */
    out->q_ddot[a] = (fb_real)ldexp((double)motion.q_ddot[a], a % 4);
  }
  memcpy(out->v, motion.v, sizeof out->v);
  memcpy(out->w, motion.w, sizeof out->w);
  memcpy(out->acceleration, motion.acceleration, sizeof out->acceleration);
  memcpy(out->w_dot, motion.w_dot, sizeof out->w_dot);
  memcpy(out->force, motion.reaction_force, sizeof out->force);
  memcpy(out->torque, motion.reaction_torque, sizeof out->torque);
  out->limit[0] = body.limit_elastic;
  out->limit[1] = body.limit_damping;
  out->limit[2] = body.limit_spin;
  out->limit[3] = body.limit_acceleration;
  out->limit[4] = body.recoil;
  out->limit[5] = body.gyration;
}

/* E8.1 to E8.22, E8.25, E8.28: any combination of the coordinates describes the same body, in every form and on every
   base, with as many coordinates, nodes and loads as there can be: bounds, accelerations, reactions, energies, momenta
   and the motion of every node. */
TEST(combined_coordinates_are_the_same_body)
{
  double worst = 0.0;
  for (int run = 0; run < 4 * FBT_FORMS; run++) {
    outcome plain, other_way;
    const fb_real *const a = (const fb_real *)&plain, *const b = (const fb_real *)&other_way;
    large_body((run / 4), (fb_base)(run % 4), FB_EFFECT_DAMPING, 0);
    large_outcome(&plain, 0);
    large_body((run / 4), (fb_base)(run % 4), FB_EFFECT_DAMPING, 1);
    large_outcome(&other_way, 1);
    for (size_t i = 0; i < sizeof plain / sizeof(fb_real); i++) {
      worst = fmax(worst, fabs((double)(a[i] - b[i])) / (1.0 + fabs((double)a[i])));
    }
    FBT_BELOW(worst, FBT_TOL(1e-12, 1e-3));
  }
  formed = NULL;
}

/* E8.15 to E8.18, E8.25, E8.27: that body, free and without damping: the work of all its loads is the change of its
   energy. */
TEST(power_of_all_loads_is_the_rate_of_energy)
{
  for (int form = 0; form < FBT_FORMS; form++) {
    fb_state state;
    fb_input input;
    large_body(form, FB_BASE_FREE, 0, 0);
    moving_state(&state, 0.05, 0);
    large_input(&input);
    FBT_NEAR_ABS(energy_rate(&state, &input, FBT_TOL(1e-5, 1e-2)), power_of(&state, &input), FBT_TOL(1e-7, 0.1));
  }
  formed = NULL;
}

/* Energy, momentum and the motion of every node with the velocities of some coordinates; what the others do is zero. */
static void some_move(outcome *out, const fb_shape *of, const int *place, int n)
{
  static fb_body_desc level;
  fb_state state;
  fb_motion motion;
  fb_real q[3][LARGE];
  memset(&level, 0, sizeof level);
  level.effects = FB_EFFECTS_FULL | FB_EFFECT_GRAVITY;
  level.gravity[1] = FB_R(2.0);
  FBT_INT_EQ(fb_body_init(&body, &body_work, of, &level), FB_OK);
  fbt_seed(31);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  memset(out, 0, sizeof *out);
  memset(&motion, 0, sizeof motion);
  fbt_fill(motion.v, 3, 1.0);
  fbt_fill(motion.w, 3, 1.0);
  fbt_fill(q[0], n, 0.1);
  fbt_fill(q[1], n, 0.5);
  fbt_fill(q[2], n, 2.0);
  for (int k = 0; k < n; k++) {
    state.q[place[k]] = q[0][k];
    motion.q_dot[place[k]] = q[1][k];
    motion.q_ddot[place[k]] = q[2][k];
    out->q_ddot[k] = body.reach[place[k]];
  }
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, motion.v, motion.w, motion.q_dot), FB_OK);
  FBT_INT_EQ(fb_body_energy_eval(&body, &out->energy, &state, NULL), FB_OK);
  FBT_INT_EQ(fb_body_momentum_eval(&body, &out->momentum, &state, NULL), FB_OK);
  for (int k = 0; k < FB_MAX_NODES; k++) {
    FBT_INT_EQ(fb_body_node_motion_eval(&body, &out->node[k], &state, &motion, k), FB_OK);
  }
}

/* E8.1: a selection of coordinates is the body whose other coordinates are held, at every node. */
TEST(a_selection_is_the_body_with_the_others_held)
{
  int place[LARGE], own[LARGE];
  for (int stride = 1; stride < 4; stride++) { /* all, and less: the last among them */
    const int n = (LARGE + stride - 1) / stride;
    outcome whole, part;
    for (int k = 0; k < n; k++) {
      place[k] = LARGE - 1 - stride * (n - 1 - k);
      own[k] = k;
    }
    large_shape(0);
    FBT_INT_EQ(fb_shape_select(&other, &shape, place, n), FB_OK);
    FBT_INT_EQ(other.n, n);
    some_move(&whole, &shape, place, n);
    some_move(&part, &other, own, n);
    FBT_BELOW(fbt_difference((const fb_real *)&whole, (const fb_real *)&part, sizeof whole / sizeof(fb_real)),
              FBT_TOL(1e-12, 2e-4));
  }
}

/* 1, or -1 for what a mirror in the plane z = 0 turns round: z of v, x and y of w, every second coordinate (1, q)_a. */
static double mirrored_velocity(int i)
{
  return i >= 2 && i <= 4 ? -1.0 : 1.0;
}

static double mirrored_coordinate(int a)
{
  return a > 0 && a % 2 == 0 ? -1.0 : 1.0;
}

/* The cloud's first half and its mirror image, with their coordinates. kg, m, units of the coordinates. */
static void mirrored_shape(int n, double kg, double m, const double *unit)
{
  FBT_INT_EQ(fb_shape_init(&shape, n), FB_OK);
  for (int i = 0; i < PARTICLES; i++) { /* the images afterwards: what cancels does so to rounding alone */
    const int image = i >= PARTICLES / 2, k = i % (PARTICLES / 2);
    fb_real r[3], psi[3 * MAX_N], chi[3 * MAX_N * MAX_N];
    for (int x = 0; x < 3; x++) {
      const double side = image ? mirrored_velocity(x) : 1.0;
      r[x] = (fb_real)(side * m * cloud.r[k][x]);
      for (int a = 0; a < n; a++) {
        const double side_a = image ? side * mirrored_coordinate(a + 1) : 1.0;
        psi[3 * a + x] = (fb_real)(side_a * unit[a] * cloud.psi[k][a][x]);
        for (int b = 0; b < n; b++) {
          const double side_ab = image ? side_a * mirrored_coordinate(b + 1) : 1.0;
          chi[3 * (a * n + b) + x] = (fb_real)(side_ab * unit[a] * unit[b] / m * cloud.chi[k][a][b][x]);
        }
      }
    }
    FBT_INT_EQ(fb_shape_add_particle(&shape, (fb_real)(kg * cloud.m[k]), r, psi, chi), FB_OK);
  }
  for (int a = 0; a < n; a++) {
    shape.K[a * n + a] = (fb_real)(kg * unit[a] * unit[a]);
  }
}

/* What the mirror turns round is no term of the energy. */
static int may_be(int i, int j, int a, int b)
{
  return mirrored_velocity(i) * mirrored_velocity(j) * mirrored_coordinate(a) * mirrored_coordinate(b) > 0.0;
}

/* Terms of Lambda, S and M that the mirror turns round. */
static int wrong_terms(void)
{
  int wrong = 0;
  for (int k = 0; k < body.n_lambda; k++) {
    const fb_lambda_term *t = &body.lambda[k];
    wrong += !may_be(t->i, 0, t->a, t->b + 1);
  }
  for (int k = 0; k < body.n_S; k++) {
    static const int moment[6] = {10, 12, 4, 15, 15, 15}; /* an element that is as c_x, c_y, c_z or W */
    const fb_lambda_term *t = &body.S[k];
    const int at = t->i < 21 ? t->i : moment[t->i - 21];
    for (int ij = 0; ij < 36; ij++) {
      wrong += fb_sym6_index(ij / 6, ij % 6) == at && !may_be(ij / 6, ij % 6, t->a, t->b);
    }
  }
  for (int k = 0; k < body.M.n_term; k++) {
    wrong += !may_be(0, 0, body.M.term[k].a + 1, body.M.term[k].b + 1);
  }
  return wrong;
}

/* How many terms there may be: of Lambda constant and linear, of S. */
static void count_terms(int count[3], int n)
{
  memset(count, 0, 3 * sizeof *count);
  for (int k = 0; k < 36 * (n + 1) * (n + 1); k++) {
    const int i = k % 6, j = k / 6 % 6, a = k / 36 % (n + 1), b = k / 36 / (n + 1);
    count[0] += j == 0 && a == 0 && b > 0 && may_be(i, 0, a, b);
    count[1] += j == 0 && a > 0 && b > 0 && may_be(i, 0, a, b);
    count[2] += j >= i && a > 0 && b <= a && may_be(i, j, a, b);
  }
}

/* E8.4 to E8.6: what is zero by a symmetry is no term, in any unit, whichever effects are on; with all of them
   everything else is one. */
TEST(what_a_symmetry_makes_zero_is_no_term)
{
  const double far = FBT_TOL(ldexp(1.0, 30), 64.0), alike[4] = {1.0, 1.0, 1.0, 1.0};
  const double kg[] = {1.0, far, 1.0 / far, 1.0, 1.0, 1.0}, m[] = {1.0, 1.0, 1.0, far, 1.0 / far, 1.0};
  const double apart[4] = {far, 1.0, 1.0 / far, 1.0};
  particles_random(&cloud, 4, 1);
  for (int run = 0; run < FBT_COUNT(kg) * FBT_COUNT(effect_sets); run++) {
    const int in = run % FBT_COUNT(kg);
    for (int n = 2; n <= 4; n += 2) {
      fb_body_desc level;
      int count[3];
      mirrored_shape(n, kg[in], m[in], in == 5 ? apart : alike);
      memset(&level, 0, sizeof level);
      level.effects = effect_sets[run / FBT_COUNT(kg)];
      level.allow_split_effects = 1;
      FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
      FBT_INT_EQ(wrong_terms(), 0);
      count_terms(count, n);
      FBT_INT_EQ(body.n_lambda_constant, count[0]);
      if (level.effects == FB_EFFECTS_FULL) {
        FBT_INT_EQ(body.n_lambda, count[0] + count[1]);
        FBT_INT_EQ(body.n_S - body.n_slope_alone, count[2]);
      }
    }
  }
}

/* E8.49: a body whose inertia forces on the modes are the slope of the kinetic energy at fixed velocities, and the same
   body with S(q) alone, whose slope is at fixed momenta, have the same rates, whether its modes are normalized by mass or
   not; M_rr has a fraction of the terms of S in its slope. */
TEST(slopes_at_fixed_velocities_are_those_at_fixed_momenta)
{
  const int n = 4;
  static fb_body momenta;
  for (int run = 0; run < 6; run++) {
    fb_body_desc level;
    fb_state state, rate, again;
    fb_real v[3] = {0}, w[3] = {FB_R(0.4), -FB_R(0.7), FB_R(0.5)}, q_dot[4];
    particles_random(&cloud, n, run + 1);
    particles_to_shape(&shape, &cloud);
    memset(&level, 0, sizeof level);
    level.effects = FB_EFFECTS_FULL;
    level.base = run % 3 == 2 ? FB_BASE_PINNED : FB_BASE_FREE;
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
    FBT_TRUE(body.by_velocities && 3 * body.n_slope < body.n_S);
    momenta = body;
    momenta.by_velocities = momenta.n_slope_alone = 0;
    momenta.n_S = momenta.n_slope = body.n_S - body.n_slope_alone;
    memmove(momenta.S, momenta.S + body.n_slope_alone, (size_t)momenta.n_S * sizeof *momenta.S);
    FBT_INT_EQ(fb_body_check(&momenta), FB_OK);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    for (int a = 0; a < n; a++) {
      state.q[a] = FB_R(0.02) * (fb_real)(a - run) / (fb_real)(a + 1);
      q_dot[a] = FB_R(0.3) * (fb_real)(a + 1 - run);
    }
    FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, w, q_dot), FB_OK);
    FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, NULL), FB_OK);
    FBT_INT_EQ(fb_body_rates_eval(&momenta, &again, &state, NULL), FB_OK);
    for (int a = 0; a < n; a++) {
      FBT_NEAR_ABS(rate.q[a], again.q[a], FBT_TOL(1e-14, 1e-6));
      FBT_NEAR_ABS(rate.pi[a], again.pi[a], FBT_TOL(1e-12, 1e-4));
    }
  }
}

/* A beam with every coordinate that a line of so many elements has, and lumps at all its nodes, offset and skew. */
static void full_beam(void)
{
  memset(&beam_desc, 0, sizeof beam_desc);
  beam_desc.length = FB_R(2.0);
  beam_desc.n_element = LARGE / 6;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = FB_R(1.0);
  beam_desc.station[0].EA = FB_R(300.0);
  beam_desc.station[0].GJ = FB_R(20.0);
  beam_desc.station[0].EI_y = FB_R(40.0);
  beam_desc.station[0].EI_z = FB_R(70.0);
  beam_desc.station[0].i_y = FB_R(0.02);
  beam_desc.station[0].i_z = FB_R(0.03);
  beam_desc.n_lump = FB_MAX_LUMPS;
  for (int k = 0; k < FB_MAX_LUMPS; k++) {
    fb_lump *const lump = &beam_desc.lump[k];
    lump->node = k % (beam_desc.n_element + 1);
    lump->mass = FB_R(0.2);
    fbt_fill(lump->center, 3, 0.1);
    lump->inertia[0] = lump->inertia[1] = lump->inertia[2] = FB_R(0.02);
    fbt_fill(lump->inertia + 3, 3, 0.005);
  }
  beam_desc.position[1] = FB_R(0.5);
  beam_desc.attitude[0] = FB_R(0.9);
  beam_desc.attitude[3] = -FB_R(0.4);
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
}

/* That beam in its element coordinates, or in combinations of them. */
static void full_beam_body(int combined)
{
  static fb_modes_desc keep;
  static fb_body_desc level;
  static const fb_real center[3] = {FB_R(0.1), -FB_R(0.2), FB_R(0.05)}, inertia[6] = {3, 4, 5};
  int node;
  memset(&keep, 0, sizeof keep);
  memset(&level, 0, sizeof level);
  keep.basis = FB_BASIS_ELEMENTS;
  for (int kind = 0; kind < FB_KIND_COUNT; kind++) {
    keep.count[kind] = 1;
  }
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(modes.n, LARGE);
  if (combined) {
    combine(modes.shape, modes.ndof);
    combine_pairs(modes.M, 1);
    combine_pairs(modes.K, 1);
  }
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(6.0), center, inertia), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  for (int k = 1; k < FB_MAX_NODES; k++) {
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, (fb_real)(2.0 * k / (FB_MAX_NODES - 1))), FB_OK);
  }
  level.effects = FB_EFFECTS_FULL;
  level.deflection_limit = FB_R(100.0);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
}

/* What that body does, bent by a static load and turning; the strain that a gauge reads. */
static void full_beam_outcome(outcome *out)
{
  static fb_real K[LARGE * LARGE];
  const fb_real v[3] = {FB_R(0.3), -FB_R(0.2), FB_R(0.1)}, w[3] = {FB_R(0.5), FB_R(1.0), -FB_R(2.0)};
  fb_real f[LARGE], q[LARGE];
  fb_gauge gauge;
  fb_state state;
  fb_motion motion;
  for (int a = 0; a < modes.n; a++) {
    const fb_node *const tip = &shape.node[FB_MAX_NODES - 1];
    f[a] = FB_R(0.5) * tip->psi[3 * a + 1] + tip->psi[3 * a + 2] + tip->psi[3 * a] + FB_R(0.5) * tip->theta[3 * a];
  }
  memcpy(K, shape.K, sizeof K);
  FBT_INT_EQ(fb_chol_factor(K, modes.n), FB_OK);
  fb_chol_solve(q, K, f, modes.n);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  memcpy(state.q, q, sizeof(fb_real) * (size_t)modes.n);
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, w, q), FB_OK);
  memset(out, 0, sizeof *out);
  FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, NULL), FB_OK);
  FBT_INT_EQ(fb_body_energy_eval(&body, &out->energy, &state, NULL), FB_OK);
  FBT_INT_EQ(fb_body_momentum_eval(&body, &out->momentum, &state, NULL), FB_OK);
  for (int k = 0; k < FB_MAX_NODES; k++) {
    FBT_INT_EQ(fb_body_node_motion_eval(&body, &out->node[k], &state, &motion, k), FB_OK);
    FBT_INT_EQ(fb_gauge_init(&gauge, 0, &beam, &modes, (fb_real)(2.0 * k / (FB_MAX_NODES - 1)), FB_R(0.1), FB_R(0.2)),
               FB_OK);
    out->q_ddot[k] = fb_gauge_eval(&gauge, state.q);
  }
  memcpy(out->acceleration, motion.acceleration, sizeof out->acceleration);
  memcpy(out->w_dot, motion.w_dot, sizeof out->w_dot);
}

/* E8.1 to E8.3, E8.14, E8.31: any combination of a beam's coordinates is the same body, with as many of them as there
   can be. */
TEST(combined_coordinates_of_a_beam_are_the_same_body)
{
  outcome plain, other_way;
  full_beam();
  full_beam_body(0);
  full_beam_outcome(&plain);
  full_beam_body(1);
  full_beam_outcome(&other_way);
  for (size_t i = 0; i < sizeof plain / sizeof(fb_real); i++) {
    const double a = (double)((const fb_real *)&plain)[i], b = (double)((const fb_real *)&other_way)[i];
    FBT_NEAR_ABS(a, b, FBT_TOL(1e-9, 1e-1) * (1.0 + fabs(a)));
  }
}

/* E8.8: a particle on a spring beside a heavy hub (mass m0, inertia I0, at the distance L along x) leaves the frame the
   hub's inertia alone where it moves: the largest ratio is 1 + m/m0 + m L^2/I0 of a free body, 1 + m L^2/I0 where O is
   held and it moves about an axis that is free, else 1; in any unit. */
TEST(recoil_is_what_springs_leave_the_frame)
{
  const double m0 = 3.0, I0 = 2.0, m = 0.5, L = 1.5;
  for (int run = 0; run < 4 * 3 * 3; run++) {
    const int base = run / 9, axis = run / 3 % 3;
    const double kg = ldexp(1.0, FBT_TOL(60, 10) * (run % 3 - 1)), held = axis == 0 ? 0.0 : m * L * L / I0;
    const double ratio[4] = {1.0 + m / m0 + held, 1.0, 1.0 + held, axis == 1 ? 1.0 + held : 1.0};
    const fb_real center[3] = {0}, r[3] = {(fb_real)L}, i0 = (fb_real)(I0 * kg), inertia[6] = {i0, i0, i0};
    fb_real psi[3] = {0};
    fb_body_desc level;
    memset(&level, 0, sizeof level);
    level.effects = FB_EFFECTS_LINEAR;
    level.base = (fb_base)base;
    psi[axis] = FB_R(0.7);
    FBT_INT_EQ(fb_shape_init(&shape, 1), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)(m0 * kg), center, inertia), FB_OK);
    FBT_INT_EQ(fb_shape_add_particle(&shape, (fb_real)(m * kg), r, psi, NULL), FB_OK);
    shape.K[0] = (fb_real)kg;
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
    FBT_NEAR_REL(body.recoil, sqrt(ratio[base]), FBT_TOL(1e-13, 1e-5));
    FBT_NEAR_REL(body.gyration, sqrt((1.5 * I0 + m * L * L) / (m0 + m)), FBT_TOL(1e-13, 1e-5));
  }
}

SUITE(body_coordinates, RUN(combined_coordinates_are_the_same_body), RUN(power_of_all_loads_is_the_rate_of_energy),
      RUN(combined_coordinates_of_a_beam_are_the_same_body), RUN(recoil_is_what_springs_leave_the_frame),
      RUN(a_selection_is_the_body_with_the_others_held), RUN(what_a_symmetry_makes_zero_is_no_term),
      RUN(slopes_at_fixed_velocities_are_those_at_fixed_momenta))
