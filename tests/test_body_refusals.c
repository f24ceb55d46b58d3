/* >>body and >>assemble: what is refused of bodies; check words. */
#include "body.h"

/* ---- as many coordinates, nodes and loads as there can be */

/* E8.22: two particles on a line through O have no inertia about it: refused, but for a base that holds that turn, in
   any direction and unit; with a little inertia about it they are a body. */
TEST(lines_of_particles_are_refused)
{
  for (int run = 0; run < 60; run++) {
    const double kg = ldexp(1.0, FBT_TOL(60, 10) * (run % 3 - 1));
    fb_real r[3], inertia[6] = {0};
    fb_body_desc level;
    int along_z;
    memset(&level, 0, sizeof level);
    for (int i = 0; i < 3; i++) { /* along an axis, in a plane, in space; whole numbers: their inertia is exact */
      r[i] = run % 5 < 2 && (run / 5 + i) % 3 < 2 - run % 5 ? FB_R(0.0) : (fb_real)floor(4.0 * fbt_random() + 0.5);
      inertia[i] = (fb_real)(0.01 * kg);
    }
    r[run / 5 % 3] += run % 5 == 0 || fbt_largest(r, 3) == 0.0 ? FB_R(8.0) : FB_R(0.0);
    along_z = r[0] == FB_R(0.0) && r[1] == FB_R(0.0);
    FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
    FBT_INT_EQ(fb_shape_add_particle(&shape, (fb_real)kg, r, NULL, NULL), FB_OK);
    for (int i = 0; i < 3; i++) {
      r[i] *= -FB_R(2.0);
    }
    FBT_INT_EQ(fb_shape_add_particle(&shape, (fb_real)kg, r, NULL, NULL), FB_OK);
    for (int more = 0; more < 2; more++) {
      const fb_status expected[4] = {FB_ERR_SINGULAR, FB_OK, FB_ERR_SINGULAR, along_z ? FB_ERR_SINGULAR : FB_OK};
      for (int base = 0; base < 4; base++) {
        level.base = (fb_base)base;
        FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), more ? FB_OK : expected[base]);
      }
      FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)kg, r, inertia), FB_OK);
    }
  }
}

/* Interface: bad input returns its status and changes nothing. */
TEST(bodies_refuse_bad_input)
{
  static fb_body_desc desc;
  static fb_body before;
  int node[2], at = -7;
  fb_state state, same;
  fb_input input;
  fb_real v[3] = {0}, w[3] = {0}, nan3[3] = {0};
  const fb_real center[3] = {0}, bad_inertia[6] = {1, 1, 5, 0, 0, 0}, inertia[6] = {1, 1, 1, 0, 0, 0};
  nan3[1] = (fb_real)NAN;
  boom_body(FB_EFFECTS_FULL, FB_BASE_FREE, node);
  memcpy(&before, &body, sizeof body);
  FBT_INT_EQ(fb_shape_init(NULL, 1), FB_ERR_NULL);
  FBT_INT_EQ(fb_shape_init(&shape, -1), FB_ERR_VALUE);
  FBT_INT_EQ(fb_shape_init(&shape, FB_MAX_MODES + 1), FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, -FB_R(1.0), center, inertia), FB_ERR_VALUE);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(1.0), center, bad_inertia), FB_ERR_VALUE);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(1.0), nan3, inertia), FB_ERR_NOT_FINITE);
  FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(1.0), nan3, modes.shape, NULL), FB_ERR_NOT_FINITE);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 1, &beam, &modes), FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &at, 0, &beam, &modes, FB_R(4.1)), FB_ERR_VALUE);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &at, 0, &beam, &modes, (fb_real)NAN), FB_ERR_NOT_FINITE);
  FBT_INT_EQ(at, -7);
  memset(&desc, 0, sizeof desc);
  desc.effects = FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA;
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_ERR_EFFECTS);
  desc.effects = 1u << 20;
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_ERR_EFFECTS);
  desc.effects = FB_EFFECTS_FULL;
  desc.zeta[0] = -FB_R(0.1);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_ERR_VALUE);
  desc.zeta[0] = (fb_real)INFINITY;
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_ERR_NOT_FINITE);
  desc.zeta[0] = 0;
  FBT_INT_EQ(fb_body_init(&body, &body_work, NULL, &desc), FB_ERR_NULL);
  FBT_TRUE(memcmp(&before, &body, sizeof body) == 0);
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK); /* no mass; then a point mass: no inertia for a free body */
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_ERR_VALUE);
  FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(1.0), center, NULL, NULL), FB_OK);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_ERR_SINGULAR);
  desc.base = FB_BASE_PRESCRIBED;
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  boom_body(FB_EFFECTS_FULL, FB_BASE_FREE, node);
  boom_state(&state, 0.01);
  same = state;
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, nan3, w, NULL), FB_ERR_NOT_FINITE);
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, NULL, NULL), FB_ERR_NULL);
  FBT_TRUE(memcmp(&same, &state, sizeof state) == 0);
  memset(&input, 0, sizeof input);
  input.n_load = FB_MAX_LOADS + 1;
  FBT_INT_EQ(fb_body_rates_eval(&body, &same, &state, &input), FB_ERR_CAPACITY);
  input.n_load = 1;
  input.load[0].node = 3;
  FBT_INT_EQ(fb_body_rates_eval(&body, &same, &state, &input), FB_ERR_CAPACITY);
  input.load[0].node = 1;
  input.load[0].axes = FB_AXES_COUNT;
  FBT_INT_EQ(fb_body_rates_eval(&body, &same, &state, &input), FB_ERR_VALUE);
  input.load[0].axes = FB_AXES_BODY;
  input.load[0].force[0] = (fb_real)NAN;
  FBT_INT_EQ(fb_body_rates_eval(&body, &same, &state, &input), FB_ERR_NOT_FINITE);
  memset(&same, 0, sizeof same);
  FBT_INT_EQ(fb_state_from_velocity(&body, &same, v, w, NULL), FB_ERR_VALUE); /* no attitude */
  FBT_TRUE(fb_rk4_limit(&body, (fb_real)NAN, 0) == FB_R(0.0));
  desc.effects = FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA | FB_EFFECT_SPIN_STIFFENING;
  desc.base = FB_BASE_FREE; /* would depend on the choice of O */
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_ERR_EFFECTS);
  state.q[0] = FB_R(1e3);
  FBT_INT_EQ(fb_state_check(&body, &state), FB_ERR_RANGE);
  state.q[0] = (fb_real)NAN;
  FBT_INT_EQ(fb_state_check(&body, &state), FB_ERR_NOT_FINITE);
}

/* Interface: a prescribed body may have no mass, nor inertia: it is as good as others, to the check and to the word. */
TEST(massless_prescribed_bodies_are_sound)
{
  static const fb_real r[3] = {1, 2, 3};
  fb_body_desc desc;
  unsigned word;
  int node;
  memset(&desc, 0, sizeof desc);
  desc.base = FB_BASE_PRESCRIBED;
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
  FBT_INT_EQ(fb_shape_add_node(&shape, &node, r, NULL, NULL), FB_OK);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  FBT_INT_EQ(fb_body_check(&body), FB_OK);
  FBT_TRUE(body.gyration == FB_R(0.0) && body.recoil == FB_R(1.0));
  word = fb_body_crc(&body);
  FBT_TRUE(word != 0);
  body.node[node].r[2] += FB_R(1.0);
  FBT_TRUE(fb_body_crc(&body) != word);
  body.base = FB_BASE_FREE; /* that one needs inertia about every axis */
  FBT_INT_EQ(fb_body_check(&body), FB_ERR_VALUE);
}

/* E8.40: what the word does not see may all be changed at once, nothing that a step reads is among it. */
TEST(the_check_word_sees_every_flipped_bit)
{
  static fb_body flipped, unseen;
  static const fb_real r[3] = {1, 2, 3}, inertia[6] = {3, 4, 5}, psi[6] = {0, 1, 0, 0, 0, 1};
  unsigned char *const bits = (unsigned char *)&flipped, *const rest = (unsigned char *)&unseen;
  const size_t every = FBT_LONG(37, 61); /* bit; of every byte: the_check_word_sees_every_effect */
  fb_body_work *const scratch = &body_work;
  fb_body_desc desc;
  fb_state state, rate, again;
  unsigned word;
  int seen = 0;
  memset(&desc, 0, sizeof desc);
  desc.effects = FB_EFFECTS_SPIN;
  FBT_INT_EQ(fb_shape_init(&shape, 2), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(9.0), r, inertia), FB_OK);
  FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(1.0), r, psi, NULL), FB_OK);
  shape.K[0] = shape.K[3] = FB_R(4.0);
  FBT_INT_EQ(fb_body_init(&body, scratch, &shape, &desc), FB_OK);
  word = fb_body_crc(&body);
  unseen = flipped = body;
  for (size_t k = 0; k < 8 * sizeof body; k += every) {
    const unsigned char whole = bits[k / 8];
    bits[k / 8] = (unsigned char)(whole ^ (1u << k % 8));
    if (fb_body_crc(&flipped) == word) {
      rest[k / 8] = (unsigned char)(rest[k / 8] ^ (1u << k % 8));
    } else {
      seen++;
    }
    bits[k / 8] = whole;
  }
  FBT_TRUE(word != 0 && seen > 8 * 100 * (int)sizeof(fb_real) / (int)every);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  state.L[2] = state.u[0] = FB_R(3.0);
  state.q[0] = state.pi[1] = FB_R(0.1);
  FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, NULL), FB_OK);
  FBT_INT_EQ(fb_body_rates_eval(&unseen, &again, &state, NULL), FB_OK);
  FBT_INT_EQ(memcmp(&rate, &again, sizeof rate), 0);
}

/* Of n numbers of the body those that may change by one bit, another one in each, without a change of its check
   word. */
static int numbers_unseen(fb_real *x, int n)
{
  const unsigned word = fb_body_crc(&body);
  unsigned char *const byte = (unsigned char *)x;
  int unseen = 0;
  for (int k = 0; k < n; k++) {
    unsigned char *const at = byte + (size_t)k * sizeof *x + (size_t)k % sizeof *x;
    *at = (unsigned char)(*at ^ (1u << k % 7));
    unseen += fb_body_crc(&body) == word;
    *at = (unsigned char)(*at ^ (1u << k % 7));
  }
  return word == 0 ? n : unseen;
}

/* E8.40: every number of a body with a quadratic field, damping and gravity: those of its nodes, of S and of the
   matrices. */
TEST(the_check_word_sees_every_number)
{
  const int n = BOOM_MODES;
  int node[2];
  boom_body(FB_EFFECTS_FULL | FB_EFFECT_DAMPING | FB_EFFECT_GRAVITY, FB_BASE_FREE, node);
  for (int k = 0; k < body.n_node; k++) {
    fb_node *const at = &body.node[k];
    FBT_INT_EQ(numbers_unseen(at->r, 3) + numbers_unseen(at->psi, 3 * n) + numbers_unseen(at->theta, 3 * n), 0);
    FBT_INT_EQ(numbers_unseen(at->chi, 3 * n * (n + 1) / 2), 0);
    FBT_INT_EQ(numbers_unseen(at->chi_theta, 3 * n * (n + 1) / 2), 0);
  }
  for (int k = 0; k < body.n_S; k += k == 39 ? body.n_S - 79 : 1) {
    FBT_INT_EQ(numbers_unseen(&body.S[k].c, 1), 0);
  }
  FBT_INT_EQ(numbers_unseen(body.S0, 21) + numbers_unseen(body.S0_inverse, 36), 0);
  FBT_INT_EQ(numbers_unseen(body.M.diagonal, n) + numbers_unseen(body.Minv.diagonal, n), 0);
  FBT_INT_EQ(numbers_unseen(body.K.diagonal, n) + numbers_unseen(body.C.diagonal, n), 0);
  FBT_INT_EQ(numbers_unseen(body.gravity, 3) + numbers_unseen(body.c, 3) + numbers_unseen(body.reach, n), 0);
  FBT_INT_EQ(numbers_unseen(&body.mass, 1) + numbers_unseen(&body.gyration, 1), 0);
  FBT_INT_EQ(numbers_unseen(&body.deflection_limit, 1) + numbers_unseen(&body.recoil, 1), 0);
  FBT_INT_EQ(numbers_unseen(&body.limit_elastic, 1) + numbers_unseen(&body.limit_damping, 1), 0);
  FBT_INT_EQ(numbers_unseen(&body.limit_spin, 1) + numbers_unseen(&body.limit_acceleration, 1), 0);
  for (int k = 0; k < body.n_lambda; k++) {
    FBT_INT_EQ(numbers_unseen(&body.lambda[k].c, 1), 0);
  }
}

/* E8.40: of changes of 33 bits in a row the word sees all but the one by its polynomial, x^32 first (IEEE 802.3,
   3.2.9), wherever in eight bytes it begins. */
TEST(the_check_word_is_that_of_its_polynomial)
{
  const unsigned long long polynomial = 0x1DB710641ull; /* the lowest bit comes first */
  int node[2];
  unsigned word;
  boom_body(FB_EFFECTS_FULL, FB_BASE_FREE, node);
  word = fb_body_crc(&body);
  for (int at = 0; at < 32; at++) {
    for (int flip = -1; flip < 33; flip++) {
      const unsigned long long other_bit = flip < 0 ? 0 : 1ull << flip, change = (polynomial ^ other_bit) << at;
      unsigned long long bits;
      memcpy(&bits, body.c, sizeof bits);
      bits ^= change;
      memcpy(body.c, &bits, sizeof bits);
      FBT_INT_EQ(fb_body_crc(&body) == word, flip < 0);
      bits ^= change;
      memcpy(body.c, &bits, sizeof bits);
    }
  }
}

/* Is a change of that index of a term seen? */
static int small_index_seen(unsigned char *index)
{
  const unsigned word = fb_body_crc(&body);
  int seen;
  *index ^= 1;
  seen = word != 0 && fb_body_crc(&body) != word;
  *index ^= 1;
  return seen;
}

/* Is a change of that index seen? */
static int index_seen(unsigned short *index)
{
  const unsigned word = fb_body_crc(&body);
  int seen;
  *index ^= 1;
  seen = word != 0 && fb_body_crc(&body) != word;
  *index ^= 1;
  return seen;
}

static int pairs_seen(fb_sparse *m)
{
  int seen = m->n_term == 3;
  for (int k = 0; k < m->n_term; k++) {
    seen = seen && numbers_unseen(&m->term[k].c, 1) == 0 && index_seen(&m->term[k].a) && index_seen(&m->term[k].b);
  }
  return seen;
}

/* E8.40: every term of a body whose modes are coupled in mass, stiffness and damping, the first and the last, too. */
TEST(the_check_word_sees_every_term)
{
  const int n = 3;
  fb_body_desc desc;
  particles_random(&cloud, n, 1);
  particles_to_shape(&shape, &cloud);
  memset(&desc, 0, sizeof desc);
  desc.effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING;
  for (int ab = 0; ab < n * n; ab++) {
    shape.K[ab] = ab % (n + 1) == 0 ? FB_R(3.0) : FB_R(0.5);
    desc.zeta[ab / n] = (fb_real)(0.1 + 0.1 * (ab / n));
  }
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  FBT_TRUE(pairs_seen(&body.M) && pairs_seen(&body.Minv) && pairs_seen(&body.K) && pairs_seen(&body.C));
  for (int k = 0; k < body.n_lambda; k++) {
    fb_lambda_term *const t = &body.lambda[k];
    FBT_TRUE(small_index_seen(&t->i) && small_index_seen(&t->a) && small_index_seen(&t->b));
  }
  for (int k = 0; k < body.n_row; k++) {
    FBT_TRUE(index_seen(&body.lambda_row[k].i) && index_seen(&body.lambda_row[k].end));
  }
  for (int k = 0; k < body.n_S; k++) {
    fb_lambda_term *const t = &body.S[k];
    FBT_INT_EQ(numbers_unseen(&t->c, 1), 0);
    FBT_TRUE(small_index_seen(&t->i) && small_index_seen(&t->a) && small_index_seen(&t->b));
  }
}

/* Interface: a row of Lambda without a term, which no flip of a single bit makes: its index is a place that a step
   writes to. */
TEST(rows_without_terms_are_refused)
{
  static fb_body spoiled;
  static const fb_real r[3] = {1, 2, 3}, inertia[6] = {3, 4, 5}, psi[6] = {0, 1, 0, 0, 0, 1};
  fb_body_desc desc;
  memset(&desc, 0, sizeof desc);
  desc.effects = FB_EFFECTS_SPIN;
  FBT_INT_EQ(fb_shape_init(&shape, 2), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(9.0), r, inertia), FB_OK);
  FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(1.0), r, psi, NULL), FB_OK);
  shape.K[0] = shape.K[3] = FB_R(4.0);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  FBT_INT_EQ(fb_body_check(&body), FB_OK);
  FBT_TRUE(body.n_row > 0 && body.n_row < 6);
  spoiled = body;
  for (int k = spoiled.n_row++; k > 0; k--) {
    spoiled.lambda_row[k] = spoiled.lambda_row[k - 1];
  }
  spoiled.lambda_row[0].i = 60000;
  spoiled.lambda_row[0].end = 0;
  FBT_INT_EQ(fb_body_check(&spoiled), FB_ERR_VALUE);
}

/* E3.2, E8.22: a rod of particles, or an inertia with nothing about its axis, turned anyhow, has no inertia about that
   axis: free or pinned it is refused, in units of mass and length of any size. With 1e-8 of the inertia across (single
   1e-4) it is a body. */
TEST(rods_without_thickness_are_refused_in_every_attitude)
{
  static const double units[5] = {1.0, 1e-6, 1e6, 1e-12, 1e12};
  fbt_seed(41);
  for (int run = 0; run < 4000; run++) {
    const double unit = units[run % FBT_TOL(5, 3)], m = unit * (1.0 + 0.5 * fbt_random());
    const double length = (1.0 + 0.5 * fbt_random()) / sqrt(unit), across = m * length * length / 12.0;
    const double off = run / 5 % 2 ? 0.5 * length : 0.0, slender = run / 10 % 2 ? FBT_TOL(1e-8, 1e-4) : 0.0;
    const int grains = slender == 0.0 && run / 20 % 2;
    const fb_real none[3] = {0};
    fb_real turn[3], quat[4], R[9], J[6], center[3];
    fb_body_desc desc;
    fb_shape rod;
    memset(&desc, 0, sizeof desc);
    desc.base = run % 3 ? FB_BASE_FREE : FB_BASE_PINNED;
    fbt_fill(turn, 3, 3.0);
    fb_quat_from_rotvec(quat, turn);
    fb_quat_to_mat33(R, quat);
    FBT_INT_EQ(fb_shape_init(&rod, 0), FB_OK);
    for (int k = 0; k < 6; k++) { /* across (1 - e e^T) + along e e^T */
      static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
      const double ee = (double)R[3 * row[k]] * (double)R[3 * column[k]];
      J[k] = (fb_real)(across * ((row[k] == column[k] ? 1.0 : 0.0) - (1.0 - slender) * ee));
    }
    for (int i = 0; i < 3; i++) {
      center[i] = (fb_real)(off * (double)R[3 * i]);
    }
    for (int k = 0; k < 5 && grains; k++) {
      fb_real r[3];
      for (int i = 0; i < 3; i++) {
        r[i] = (fb_real)((off + length * (k - 2) / 4.0) * (double)R[3 * i]);
      }
      FBT_INT_EQ(fb_shape_add_particle(&rod, (fb_real)(m / 5.0), r, none, NULL), FB_OK);
    }
    if (!grains) {
      FBT_INT_EQ(fb_shape_add_rigid(&rod, (fb_real)m, center, J), FB_OK);
    }
    FBT_INT_EQ(fb_body_init(&body, &body_work, &rod, &desc), slender > 0.0 ? FB_OK : FB_ERR_SINGULAR);
  }
}

/* Interface: what a load is not: a number, on a base that is held and takes it without moving. */
TEST(loads_that_are_no_numbers_are_refused_on_held_bases)
{
  static const fb_base base[] = {FB_BASE_FREE, FB_BASE_PRESCRIBED, FB_BASE_PINNED, FB_BASE_HINGED};
  const fb_real center[3] = {0}, inertia[6] = {1, 1, 1, 0, 0, 0};
  for (int run = 0; run < 8; run++) {
    static fb_body_desc held;
    static fb_rk4_work rk4;
    fb_input input;
    fb_state state;
    fb_motion motion;
    memset(&held, 0, sizeof held);
    memset(&input, 0, sizeof input);
    held.base = base[run / 2];
    input.n_load = 1;
    (run % 2 ? input.load[0].torque : input.load[0].force)[1] = (fb_real)NAN;
    FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(1.0), center, inertia), FB_OK);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &held), FB_OK);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &input), FB_ERR_NOT_FINITE);
    FBT_INT_EQ(fb_rk4_step(&body, &state, &rk4, &input, &input, &input, FB_R(1e-3)), FB_ERR_NOT_FINITE);
  }
}

/* Interface: what nothing would use is refused: damping ratios without the effect damping, gravity without the effect
   gravity. */
TEST(values_without_their_effect_are_refused)
{
  static const unsigned effect[2] = {FB_EFFECT_DAMPING, FB_EFFECT_GRAVITY};
  int node[2];
  boom(&shape, node);
  for (int k = 0; k < 4; k++) {
    fb_body_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.effects = FB_EFFECTS_FULL | (k / 2 ? effect[k % 2] : effect[1 - k % 2]);
    *(k % 2 ? &desc.gravity[2] : &desc.zeta[BOOM_MODES - 1]) = FB_R(0.02);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), k / 2 ? FB_OK : FB_ERR_EFFECTS);
  }
}

/* Interface: a model that is all zero was never initialized. Nothing is made of it, and no step blames its deflection. */
TEST(models_that_were_never_initialized_are_told)
{
  static fb_body zero;
  static fb_state at;
  static fb_rk4_work rk4;
  static fb_motion moving;
  static fb_system_desc one;
  static fb_system no_system;
  static fb_system_work tree;
  static fb_system_state tree_at;
  static fb_exact no_beam;
  static fb_exact_state beam_at;
  static fb_exact_work beam_work;
  static fb_stepper stepper;
  static fb_stepper_desc way;
  FBT_INT_EQ(fb_state_init(&zero, &at), FB_ERR_INIT);
  at.quat[0] = FB_R(1.0);
  FBT_INT_EQ(fb_state_check(&zero, &at), FB_ERR_INIT);
  FBT_INT_EQ(fb_rk4_step(&zero, &at, &rk4, NULL, NULL, NULL, FB_R(0.01)), FB_ERR_INIT);
  FBT_INT_EQ(fb_body_motion_eval(&zero, &moving, &at, NULL), FB_ERR_INIT);
  way.body = &zero;
  way.state = &at;
  way.dt = FB_R(0.01);
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_ERR_INIT);
  one.n_body = 1;
  FBT_INT_EQ(fb_system_init(&no_system, &tree, &zero, &one, 1), FB_ERR_INIT);
  FBT_INT_EQ(fb_system_state_init(&no_system, &zero, &tree_at, &tree, NULL, NULL), FB_ERR_INIT);
  FBT_INT_EQ(fb_system_state_check(&no_system, &zero, &tree_at), FB_ERR_INIT);
  FBT_INT_EQ(fb_exact_state_init(&no_beam, &beam_at, &beam_work, NULL), FB_ERR_INIT);
  FBT_INT_EQ(fb_exact_state_check(&no_beam, &beam_at), FB_ERR_INIT);
}

SUITE(body_refusals, RUN(models_that_were_never_initialized_are_told), RUN(values_without_their_effect_are_refused),
      RUN(loads_that_are_no_numbers_are_refused_on_held_bases),
      RUN(rods_without_thickness_are_refused_in_every_attitude), RUN(rows_without_terms_are_refused),
      RUN(massless_prescribed_bodies_are_sound), RUN(the_check_word_sees_every_flipped_bit),
      RUN(the_check_word_sees_every_number), RUN(the_check_word_sees_every_term),
      RUN(the_check_word_is_that_of_its_polynomial), RUN(lines_of_particles_are_refused), RUN(bodies_refuse_bad_input))
