/* >>system: what is refused of systems, their states and inputs, and what memory has changed. */
#include "system.h"

static fb_system_state kept;

/* Interface: whatever is in the work before a call, it does the same, to the last bit; by either method and with a
   loop. */
TEST(work_means_nothing_between_calls)
{
  static fb_system_state begin[2], slope[2], after[2];
  static fb_system_motion at[2];
  for (int form = 0; form < 3; form++) {
    fb_energy energy[2];
    fb_momentum momentum[2];
    couple(FB_JOINT_REVOLUTE, 0, FB_AXIS_FREE);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    if (form == 2) {
      couple_by_a_loop(&motion, 0);
    }
    init(form < 2 ? form : (int)FB_METHOD_RECURSIVE);
    for (int k = 0; k < 2; k++) {
      const int byte = k ? 0xff : 0;
      memset(&work, byte, sizeof work);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &begin[k], &work, start, &input), FB_OK);
      memset(&work, byte, sizeof work);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &at[k], &begin[k], &input), FB_OK);
      memset(&work, byte, sizeof work);
      FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &slope[k], &begin[k], &input), FB_OK);
      memset(&work, byte, sizeof work);
      FBT_INT_EQ(fb_system_energy_eval(&mechanism, model, &work, &energy[k], &begin[k], &input), FB_OK);
      memset(&work, byte, sizeof work);
      FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &momentum[k], &begin[k], &input), FB_OK);
      after[k] = begin[k];
      memset(&work, byte, sizeof work);
      FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &after[k], &work, form < 2 ? 1 : 2, 0, FB_AXIS_LOCKED, &input),
                 FB_OK);
      memset(&work, byte, sizeof work);
      init(form < 2 ? form : (int)FB_METHOD_RECURSIVE);
    }
    FBT_TRUE(memcmp(&begin[0], &begin[1], sizeof begin[0]) == 0);
    FBT_TRUE(memcmp(&at[0], &at[1], sizeof at[0]) == 0);
    FBT_TRUE(memcmp(&slope[0], &slope[1], sizeof slope[0]) == 0);
    FBT_TRUE(memcmp(&after[0], &after[1], sizeof after[0]) == 0);
    FBT_TRUE(memcmp(&energy[0], &energy[1], sizeof energy[0]) == 0);
    FBT_TRUE(memcmp(&momentum[0], &momentum[1], sizeof momentum[0]) == 0);
  }
}

/* Interface: no input is one of zeros, to the last bit: motors are off, prescribed axes and bodies stand at zero; in
   joint coordinates, by the dense matrix and as a loop. */
TEST(no_input_is_an_input_of_zeros)
{
  static fb_system_motion at[2];
  static fb_system_state begin[2], end[2], slope[2];
  static const fb_joint_kind kinds[] = {FB_JOINT_CYLINDRICAL, FB_JOINT_UNIVERSAL, FB_JOINT_SPHERICAL};
  for (int run = 0; run < 18; run++) {
    const fb_axis_mode mode = run / 3 % 2 ? FB_AXIS_PRESCRIBED : FB_AXIS_FREE;
    const int form = run / 6;
    couple(kinds[run % 3], 0, mode);
    desc.joint[0].mode[0] = mode;
    memset(&input, 0, sizeof input);
    if (form == 2) {
      init(FB_METHOD_RECURSIVE);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
      couple_by_a_loop(&motion, 0);
    }
    init(form < 2 ? form : (int)FB_METHOD_RECURSIVE);
    for (int zeros = 0; zeros < 2; zeros++) {
      const fb_system_input *in = zeros ? &input : NULL;
      fb_system_state *s = &end[zeros];
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &begin[zeros], &work, start, in), FB_OK);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &at[zeros], &begin[zeros], in), FB_OK);
      FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &slope[zeros], &begin[zeros], in), FB_OK);
      *s = begin[zeros];
      memset(&work, 0xff, sizeof work); /* and what is in it means nothing */
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, s, &work, in, in, in, FB_R(2e-4)), FB_OK);
      FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, s, &work, in, in, FB_R(2e-4), 2), FB_OK);
      FBT_INT_EQ(fb_system_axis_set(&mechanism, model, s, &work, form < 2 ? 1 : 2, 0, FB_AXIS_LOCKED, in), FB_OK);
    }
    FBT_TRUE(memcmp(&begin[0], &begin[1], sizeof begin[0]) == 0);
    FBT_TRUE(memcmp(&at[0], &at[1], sizeof at[0]) == 0);
    FBT_TRUE(memcmp(&slope[0], &slope[1], sizeof slope[0]) == 0);
    FBT_TRUE(memcmp(&end[0], &end[1], sizeof end[0]) == 0);
    if (mode == FB_AXIS_PRESCRIBED && kinds[run % 3] != FB_JOINT_SPHERICAL) {
      FBT_NEAR_ABS(at[0].joint[form < 2 ? 1 : 2].value[0], 0.0, FBT_TOL(1e-12, 1e-4));
      FBT_NEAR_ABS(at[0].joint[form < 2 ? 1 : 2].speed[0], 0.0, FBT_TOL(1e-12, 1e-4));
    }
    FBT_NEAR_ABS(slope[0].motor_work, 0.0, 0.0);
  }
}

/* One field changed by as little as makes it wrong. */
static void refused_with(void *field, int value)
{
  int was;
  memcpy(&was, field, sizeof was);
  memcpy(field, &value, sizeof value);
  FBT_TRUE(fb_system_check(&mechanism, model, 1) != FB_OK);
  memcpy(field, &was, sizeof was);
}

static void refused_without(fb_real *field, int n)
{
  for (int i = 0; i < n; i++) {
    const fb_real was = field[i];
    field[i] = (fb_real)NAN;
    FBT_TRUE(fb_system_check(&mechanism, model, 1) != FB_OK);
    field[i] = was;
  }
}

/* Interface: fb_system_check: every field beyond its range, of the system, of a joint of the tree and of one that
   closes a loop, is found; at the ends of the range all is well. */
TEST(systems_that_memory_has_changed_are_refused)
{
  fb_joint *joint = mechanism.joint;
  couple(FB_JOINT_SPHERICAL, 0, FB_AXIS_FREE);
  close_loop(FB_JOINT_REVOLUTE, 1, 2, 0, 2);
  close_loop(FB_JOINT_REVOLUTE, FB_GROUND, 0, 1, 0);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_check(&mechanism, model, 1), FB_OK);
  FBT_INT_EQ(fb_system_check(&mechanism, model, 0), FB_ERR_CAPACITY);
  refused_with(&mechanism.n_body, 0);
  refused_with(&mechanism.n_body, FB_MAX_BODIES + 1);
  refused_with(&mechanism.n_loop, -1);
  refused_with(&mechanism.n_loop, FB_MAX_LOOPS + 1);
  refused_with(&mechanism.method, FB_METHOD_COUNT);
  refused_with(&mechanism.allow_long_step, 2);
  refused_with(&mechanism.model[1], 1);
  refused_with(&mechanism.model[1], -1);
  refused_with(&mechanism.coupled[0], 2);
  refused_without(&mechanism.limit_elastic, 1);
  refused_without(&mechanism.limit_damping, 1);
  refused_without(&mechanism.limit_loop_elastic, 1);
  refused_without(&mechanism.limit_loop_damping, 1);
  refused_with(&joint[0].parent, 0);      /* a body hangs on an earlier one */
  refused_with(&joint[0].parent_node, 1); /* the ground has one node, */
  refused_with(&joint[0].moves, 1);       /* which does not bend */
  refused_with(&joint[1].parent, 1);
  refused_with(&joint[1].child, 0);
  for (int j = 1; j < 3; j++) {
    refused_with(&joint[j].kind, FB_JOINT_COUNT);
    refused_with(&joint[j].parent, FB_GROUND - 1);
    refused_with(&joint[j].parent, 2);
    refused_with(&joint[j].child, 2);
    refused_with(&joint[j].child, -1);
    refused_with(&joint[j].parent_node, -1);
    refused_with(&joint[j].parent_node, 3);
    refused_with(&joint[j].child_node, -1);
    refused_with(&joint[j].child_node, 3);
    refused_with(&joint[j].n_axis, joint[j].n_axis - 1);
    refused_with(&joint[j].n_axis, joint[j].n_axis + 1);
    refused_with(&joint[j].moves, 2);
    refused_with(&joint[j].turned, 2);
    refused_without(joint[j].position, 3);
    refused_without(joint[j].axes, 9);
    refused_without(joint[j].child_position, 3);
    refused_without(joint[j].child_axes, 9);
    refused_without(joint[j].A, 18);
    refused_without(&joint[j].pitch, 1);
    refused_without(joint[j].stiffness, 3);
    refused_without(joint[j].rest, 3);
    refused_without(joint[j].damping, 3);
    for (int i = 0; i < 3; i++) {
      const fb_real stiffness = joint[j].stiffness[i], damping = joint[j].damping[i];
      refused_with(&joint[j].mode[i], FB_AXIS_COUNT);
      joint[j].stiffness[i] = -FB_R(1.0);
      FBT_TRUE(fb_system_check(&mechanism, model, 1) != FB_OK);
      joint[j].stiffness[i] = stiffness;
      joint[j].damping[i] = -FB_R(1.0);
      FBT_TRUE(fb_system_check(&mechanism, model, 1) != FB_OK);
      joint[j].damping[i] = damping;
    }
  }
}

/* Interface: fb_system_state_check, and what fb_system_state_init takes: attitudes where there are any, modes, where
   locked axes are; as far as a body may be deflected and no further. */
TEST(states_out_of_range_are_refused)
{
  const int beyond = FB_AXIS_COUNT;
  for (int j = 0; j < 3; j++) { /* free, spherical, revolute */
    couple(FB_JOINT_SPHERICAL, 0, FB_AXIS_FREE);
    hang(2, 0, FB_JOINT_REVOLUTE, 1, 1);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_state_check(&mechanism, model, &state), FB_OK);
    kept = state;
    memset(kept.link[j].quat, 0, sizeof kept.link[j].quat);
    FBT_INT_EQ(fb_system_state_check(&mechanism, model, &kept) == FB_OK, j == 2);
    for (int i = 0; i < 3; i++) {
      kept = state;
      kept.mode[j][i] = FB_AXIS_PRESCRIBED;
      FBT_INT_EQ(fb_system_state_check(&mechanism, model, &kept), FB_OK);
      memcpy(&kept.mode[j][i], &beyond, sizeof beyond);
      FBT_INT_EQ(fb_system_state_check(&mechanism, model, &kept), FB_ERR_VALUE);
      kept = state;
      kept.hold[j][i] = (fb_real)NAN;
      FBT_INT_EQ(fb_system_state_check(&mechanism, model, &kept), FB_ERR_NOT_FINITE);
      kept = state;
      kept.link[j].x[i] = (fb_real)NAN;
      FBT_INT_EQ(fb_system_state_check(&mechanism, model, &kept), FB_ERR_NOT_FINITE);
    }
    for (int over = 0; over < 2; over++) { /* the parts of two modes add up, whatever their signs */
      const double limit = (double)model[0].deflection_limit;
      start[j].q[0] = (fb_real)(0.6 * limit / (double)model[0].reach[0]);
      start[j].q[1] = -(fb_real)((over ? 0.42 : 0.38) * limit / (double)model[0].reach[1]);
      start[j].q[2] = FB_R(0.0);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &kept, &work, start, NULL), over ? FB_ERR_RANGE : FB_OK);
    }
  }
}

/* E9.15: how far a body may be deflected holds for each of its modes alone, of every body. */
TEST(every_mode_is_within_its_range)
{
  fresh();
  flexible(&model[0], 2, 2, 0, FB_EFFECTS_FULL);
  hang(0, 0, FB_JOINT_RIGID, FB_GROUND, 0);
  hang(1, 0, FB_JOINT_RIGID, FB_GROUND, 0);
  init(FB_METHOD_RECURSIVE);
  for (int run = 0; run < 16; run++) {
    const int k = run / 8, a = run / 2 % 4, over = run % 2;
    memset(start, 0, sizeof start);
    start[k].q[a] = (fb_real)(over ? 1.01 : 0.99) * model[0].deflection_limit / model[0].reach[a];
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), over ? FB_ERR_RANGE : FB_OK);
  }
}

static unsigned tree_word(void)
{
  return fb_system_crc(&mechanism, model, FB_MAX_BODIES);
}

/* E8.40: of a system the word sees all but unused joints and springs and the padding of the others, and its models. */
TEST(the_check_word_of_a_system_sees_every_byte)
{
  const int pad = (int)(sizeof(fb_joint) - 82 * sizeof(fb_real) - 14 * sizeof(int));
  unsigned word;
  int joints, most;
  tree(FB_EFFECTS_SPIN, 1);
  (void)close_loop(FB_JOINT_SPHERICAL, 4, 0, 6, 0);
  desc.n_spring = 1;
  desc.spring[0].body[1] = 3;
  desc.spring[0].stiffness = FB_R(10.0);
  init(FB_METHOD_RECURSIVE);
  joints = mechanism.n_body + mechanism.n_loop;
  most = (int)sizeof(fb_joint) * (FBT_COUNT(mechanism.joint) - joints) + pad * (joints + 1) +
         2 * (int)sizeof(int) * (FB_MAX_BODIES - mechanism.n_body) + (int)(sizeof(fb_real) - sizeof(int)) +
         (int)sizeof(fb_spring) * (FB_MAX_SPRINGS - mechanism.n_spring);
  FBT_TRUE(pad < (int)sizeof(fb_real));
  FBT_TRUE(fbt_unseen(&mechanism, sizeof mechanism, tree_word) <= most);
  word = tree_word();
  for (int k = 0; k < 3; k++) {
    model[k].mass += FB_R(1.0);
    FBT_TRUE(tree_word() != word);
    model[k].mass -= FB_R(1.0);
  }
  FBT_INT_EQ(fb_system_crc(&mechanism, model, 2) == 0, 1); /* there is a third model */
  model[3] = model[2];
  mechanism.model[mechanism.n_body - 1] = 3;
  word = tree_word();
  model[3].mass += FB_R(1.0);
  FBT_TRUE(tree_word() != word);
  model[1].n = FB_MAX_MODES + 1;
  FBT_INT_EQ(tree_word() == 0, 1);
  FBT_INT_EQ(fb_system_crc(&mechanism, model, 1) == 0, 1); /* there are more models */
  FBT_INT_EQ(fb_system_crc(&mechanism, model, 0) == 0, 1);
  model[1].n = 0;
  for (int beyond = 0; beyond < 4; beyond++) {
    int *const count = beyond % 2 ? &mechanism.n_loop : &mechanism.n_body, was = *count;
    *count = beyond < 2 ? -1 : (beyond % 2 ? FB_MAX_LOOPS : FB_MAX_BODIES) + 1;
    FBT_INT_EQ(tree_word() == 0, 1);
    *count = was;
  }
}

/* Interface: a free body has no parent, whatever the desc says of one: the system is sound and has the same word. */
TEST(free_bodies_have_no_parent)
{
  unsigned word = 0;
  for (int said = 0; said < 2; said++) {
    fresh();
    flexible(&model[0], 1, 0, 0, FB_EFFECTS_FULL);
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    hang(1, 0, FB_JOINT_FREE, said ? 0 : FB_GROUND, said);
    init(FB_METHOD_RECURSIVE);
    FBT_TRUE(!said || fb_system_crc(&mechanism, model, 1) == word);
    word = fb_system_crc(&mechanism, model, 1);
  }
}

/* What was found in review: work that holds anything, loops torn open, half a turn off, springs of loops in the limits,
   prescribed axes from the start, many rows, small attitudes, power of what is prescribed. */
static int many_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  const int n = *(const int *)user;
  (void)pose, (void)t;
  for (int k = 0; k < n && k < capacity; k++) { /* the same one over and over */
    row[k].body[1] = FB_GROUND;
    row[k].force[0][0] = FB_R(1.0);
  }
  return n < capacity ? n : capacity;
}

/* Interface: what is missing, not a number or out of range in a description, an input or a state. */
TEST(systems_refuse_what_is_not_right)
{
  int many = 30;
  fb_real limit;
  tree(FB_EFFECTS_FULL, 0); /* the work means nothing between calls */
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  kept = state;
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &kept, &work, &input, &input, &input, FB_R(2e-4)), FB_OK);
  memset(&work, 0xff, sizeof work);
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(2e-4)), FB_OK);
  FBT_TRUE(memcmp(&kept, &state, sizeof state) == 0);
  memset(&work, 0xff, sizeof work);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
  memset(&work, 0xff, sizeof work);
  FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, FB_R(2e-4), 0), FB_OK);
  fourbar(0.4, 1.0, 0.8, 1.1, FB_JOINT_REVOLUTE); /* the rocker's value jumps: the loop cannot follow */
  desc.joint[0].mode[0] = desc.joint[2].mode[0] = FB_AXIS_PRESCRIBED;
  input.drive[0].value[0] = FB_R(0.7);
  input.drive[2].value[0] = (fb_real)rocker_angle(0.4, 1.0, 0.8, 1.1, 0.7);
  start[1].value[0] = -FB_R(0.3);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  input.drive[2].value[0] += FB_R(0.02);
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(1e-3)),
             FB_ERR_CONTRADICTION);
  FBT_INT_EQ(work.joint, 3);
  fresh(); /* a hinge closed upside down */
  rigid(&model[0], 1.0, 0.2, 0, 0, 0.1, 0.1, 0.1);
  hang(0, 0, FB_JOINT_SPHERICAL, FB_GROUND, 0);
  close_loop(FB_JOINT_REVOLUTE, FB_GROUND, 0, 0, 0);
  turn(start[0].quat, 3.0, 0, 0);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_ERR_CONTRADICTION);
  FBT_INT_EQ(work.joint, 1);
  desc.loop[0].stiffness[0] =
      FB_R(400.0); /* and its spring in the limit: sqrt(400/(0.1 + 0.04)), 5 % more of the tree's */
  init(FB_METHOD_RECURSIVE);
  limit = fb_system_rk4_limit(&mechanism, model, 0, 0);
  FBT_NEAR_REL(limit, 2.785 / sqrt(400.0 / 0.14), FBT_TOL(1e-9, 1e-4));
  turn(start[0].quat, 0, 0, 0.1);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, FB_R(1.01) * limit), FB_ERR_STEP);
  FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, NULL, NULL, FB_R(1.01) * limit, 0), FB_ERR_STEP);
  fresh(); /* prescribed from the start: the other joint's speed stays what it was asked to be */
  rigid(&model[0], 1.0, 0, -0.5, 0, 0.1, 0.1, 0.1);
  hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
  hang(1, 0, FB_JOINT_REVOLUTE, 0, 1);
  desc.joint[0].mode[0] = FB_AXIS_PRESCRIBED;
  input.drive[0].value[0] = FB_R(1.0);
  input.drive[0].rate[0] = FB_R(2.0);
  start[1].value[0] = FB_R(0.5);
  start[1].speed[0] = FB_R(0.25);
  for (int form = 0; form < FORMS; form++) {
    init(form);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    motion_of(&motion, &state);
    FBT_NEAR_ABS(motion.joint[1].speed[0], 0.25, FBT_TOL(1e-12, 1e-5));
    FBT_NEAR_ABS(motion.joint[1].value[0], 0.5, FBT_TOL(1e-12, 1e-5));
  }
  fresh(); /* many rows, more than half of what there is room for; a body dragged along; its power */
  rigid(&model[0], 2.0, 0, 0, 0, 0.1, 0.1, 0.1);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  input.rows = many_rows;
  input.user = &many;
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, NULL, &input), FB_OK);
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(1e-3)), FB_OK);
  FBT_INT_EQ(work.rank, 1);
  many = -7;
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(1e-3)), -7);
  fresh();
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  desc.joint[0].mode[0] = FB_AXIS_PRESCRIBED;
  input.drive[0].rate[0] = FB_R(3.0);
  input.drive[0].acceleration[0] = FB_R(5.0);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, NULL, &input), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
  FBT_NEAR_ABS(motion.power, 2.0 * 5.0 * 3.0, FBT_TOL(1e-12, 1e-4));
  fresh(); /* an attitude of a hundred-millionth of a turn is one */
  hang(0, 0, FB_JOINT_RIGID, FB_GROUND, 0);
  turn(desc.joint[0].child_attitude, 1e-9, 0, 0);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, NULL, NULL), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
  FBT_NEAR_ABS(motion.pose[0].quat[1], -0.5e-9, 1e-13);
}

/* Interface: a torque of an axis that a joint does not have, or of a free joint, which has no motor, would do nothing:
   it is refused, of every kind of joint and of one that closes a loop. */
TEST(torques_without_a_motor_are_refused)
{
  for (int kind = 0; kind < FB_JOINT_COUNT; kind++) {
    couple((fb_joint_kind)kind, 0, FB_AXIS_FREE);
    memset(&input, 0, sizeof input);
    memset(desc.joint[1].stiffness, 0, sizeof desc.joint[1].stiffness); /* free joints have none */
    memset(desc.joint[1].damping, 0, sizeof desc.joint[1].damping);
    desc.joint[1].parent = kind == FB_JOINT_FREE ? FB_GROUND : 0;
    desc.joint[1].parent_node = kind == FB_JOINT_FREE ? 0 : 1;
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, NULL, NULL), FB_OK);
    for (int i = 0; i < 3; i++) {
      const int has = kind != FB_JOINT_FREE && i < axes_of(kind)->count;
      input.drive[1].torque[i] = FB_R(1.0);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), has ? FB_OK : FB_ERR_VALUE);
      input.drive[1].torque[i] = FB_R(0.0);
    }
  }
  couple(FB_JOINT_REVOLUTE, 0, FB_AXIS_FREE);
  memset(&input, 0, sizeof input);
  close_loop(FB_JOINT_REVOLUTE, FB_GROUND, 0, 1, 0);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, NULL, NULL), FB_OK);
  input.drive[2].torque[1] = FB_R(1.0);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_ERR_VALUE);
}

/* Interface: a load that is no number is refused, also where nothing gives way to it: a root that is prescribed, a body
   fixed to the ground. */
TEST(loads_that_are_no_numbers_are_refused)
{
  static const fb_joint_kind root[] = {FB_JOINT_FREE, FB_JOINT_RIGID};
  static fb_system_state slope;
  for (int k = 0; k < FBT_COUNT(root); k++) {
    fresh();
    rigid(&model[0], 2.0, 0, 0, 0, 0.1, 0.1, 0.1);
    hang(0, 0, root[k], FB_GROUND, 0);
    desc.joint[0].mode[0] = FB_AXIS_PRESCRIBED;
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, NULL, NULL), FB_OK);
    kept = state;
    input.n_load = 1;
    (k ? input.load[0].load.torque : input.load[0].load.force)[1] = (fb_real)NAN;
    FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &slope, &state, &input), FB_ERR_NOT_FINITE);
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(1e-3)),
               FB_ERR_NOT_FINITE);
    FBT_TRUE(memcmp(&state, &kept, sizeof state) == 0);
  }
}

/* Interface: a model that no body has, of as many models as bodies: desc.model was forgotten, and the default, 0, would
   double another body. An array of more or fewer models may hold spare ones. */
TEST(forgotten_models_are_refused)
{
  couple(FB_JOINT_REVOLUTE, 0, FB_AXIS_FREE);
  model[1] = model[2] = model[0];
  for (int k = 0; k < 2; k++) {
    desc.model[1] = k;
    FBT_INT_EQ(fb_system_init(&mechanism, &work, model, &desc, 1 + k), FB_OK);
    FBT_INT_EQ(fb_system_init(&mechanism, &work, model, &desc, 2), k ? FB_OK : FB_ERR_VALUE);
    FBT_INT_EQ(fb_system_init(&mechanism, &work, model, &desc, 3), FB_OK);
  }
}

static double start_offset; /* [rad] of what is given to the step, beyond the state's value */

/* One step of a prescribed axis from the value 0.3 rad to `value`, with these rates at its start, middle and end. */
static fb_status step_prescribed(double value, double first, double middle, double last, double dt)
{
  static fb_system_input in[3];
  const double rate[3] = {first, middle, last};
  memset(in, 0, sizeof in);
  for (int k = 0; k < 3; k++) {
    in[k].drive[joint_at[1]].value[0] = (fb_real)(k == 0 ? 0.3 : k == 1 ? 0.5 * (0.3 + value) : value);
    in[k].drive[joint_at[1]].rate[0] = (fb_real)rate[k];
  }
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &in[0]), FB_OK);
  kept = state;
  for (int k = 0; k < 3; k++) {
    in[k].drive[joint_at[1]].value[0] += (fb_real)start_offset;
  }
  return implicit ? fb_system_sdirk_step(&mechanism, model, &state, &work, &in[0], &in[2], (fb_real)dt, 3)
                  : fb_system_rk4_step(&mechanism, model, &state, &work, &in[0], &in[1], &in[2], (fb_real)dt);
}

/* Interface: a prescribed value that stays while its rate says that it moves is refused and named, by either method, of a loop, and by
   both integrators, and one that jumps, in the step or from where the state has it, by more than its rates say; one
   that moves by less than its rounding, comes back to where it was, follows in part, is counted anew after a turn, or
   is held over the step, is not. */
TEST(a_prescribed_value_that_denies_its_rate_is_refused)
{
  const double dt = 1e-3;
  fresh();
  rigid(&model[0], 2, 0.5, 0, 0, 0.1, 0.4, 0.4);
  hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
  hang(1, 0, FB_JOINT_REVOLUTE, 0, 1);
  desc.joint[1].mode[0] = FB_AXIS_PRESCRIBED;
  for (int form = 0; form < FORMS; form++) {
    memset(&input, 0, sizeof input);
    input.drive[1].value[0] = FB_R(0.3);
    init(form);
    for (implicit = 0; implicit <= 1; implicit++) {
      FBT_INT_EQ(step_prescribed(0.3, 2, 2, 2, dt), FB_ERR_CONTRADICTION);
      FBT_INT_EQ(work.joint, joint_at[1]);
      FBT_TRUE(memcmp(&state, &kept, sizeof state) == 0);
      FBT_INT_EQ(step_prescribed(0.3 + 2 * dt, 2, 2, 2, dt), FB_OK);
      FBT_INT_EQ(step_prescribed(0.3, 0, 0, 0, dt), FB_OK);
      FBT_INT_EQ(step_prescribed(0.3, 1e-18, 1e-18, 1e-18, dt), FB_OK);
      FBT_INT_EQ(step_prescribed(0.3, 1, 0, -1, dt), FB_OK);
      FBT_INT_EQ(step_prescribed(0.4, 0, 0, 0, dt), FB_ERR_CONTRADICTION);
      FBT_TRUE(memcmp(&state, &kept, sizeof state) == 0);
      FBT_INT_EQ(step_prescribed(0.3 + 5 * dt, 2, 2, 2, dt), FB_ERR_CONTRADICTION);
      FBT_INT_EQ(step_prescribed(0.3 + 1 * dt, 2, 2, 2, dt), FB_OK);
      FBT_INT_EQ(step_prescribed((double)NAN, 2, 2, 2, dt), FB_ERR_NOT_FINITE);
      FBT_INT_EQ(step_prescribed(0.3 + dt, 1, 1, (double)NAN, dt), FB_ERR_NOT_FINITE);
      FBT_INT_EQ(step_prescribed(0.3 + 2 * dt, 2, 2, 2, -1.0), FB_ERR_VALUE);
      FBT_INT_EQ(step_prescribed(0.3 + 2 * dt, 2, 2, 2, (double)NAN), FB_ERR_VALUE);
      for (int turns = -1; turns <= 50; turns += 17) { /* the same place */
        start_offset = turns * 8 * atan(1.0);
        FBT_INT_EQ(step_prescribed(0.3 + 2 * dt, 2, 2, 2, dt), FB_OK);
      }
      start_offset = 0.0;
    }
    if (form != AS_LOOPS) { /* whose state has no values; values counted anew, a jump between steps */
      static fb_system_input in[3];
      const double values[3] = {1.0, 1.0 + dt, 1.0 + 2 * dt - 8 * atan(1.0)};
      memset(in, 0, sizeof in);
      for (int k = 0; k < 3; k++) {
        in[k].drive[1].value[0] = (fb_real)values[k];
        in[k].drive[1].rate[0] = FB_R(2.0);
      }
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, NULL, &in[0]), FB_OK);
      kept = state;
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &in[0], &in[1], &in[2], (fb_real)dt), FB_OK);
      state = kept;
      FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, &in[0], &in[2], (fb_real)dt, 3),
                 FB_ERR_CONTRADICTION);                  /* which goes straight from the one to the other */
      for (int left_out = 0; left_out < 3; left_out++) { /* NULL is an input of zeros: away at once and back */
        const fb_system_input *at[3] = {&in[0], &in[1], &in[2]};
        at[left_out] = NULL;
        state = kept;
        FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, at[0], at[1], at[2], (fb_real)dt),
                   FB_ERR_CONTRADICTION);
        FBT_TRUE(memcmp(&state, &kept, sizeof state) == 0);
      }
      for (int k = 0; k < 3; k++) {
        in[k].drive[1].value[0] += k < 2 ? FB_R(0.1) : FB_R(0.1) + (fb_real)(8 * atan(1.0));
      }
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &in[0], &in[1], &in[2], (fb_real)dt),
                 FB_ERR_CONTRADICTION);
      FBT_TRUE(memcmp(&state, &kept, sizeof state) == 0);
    }
    memset(&input, 0, sizeof input); /* a ramp, each step with the input of its start */
    input.drive[1].rate[0] = FB_R(1.0);
    implicit = 0;
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, NULL, &input), FB_OK);
    for (int k = 0; k < 5; k++) {
      input.drive[1].value[0] = (fb_real)(k * dt);
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, (fb_real)dt), FB_OK);
    }
  }
}

SUITE(system_refusals, RUN(torques_without_a_motor_are_refused), RUN(forgotten_models_are_refused),
      RUN(loads_that_are_no_numbers_are_refused), RUN(a_prescribed_value_that_denies_its_rate_is_refused),
      RUN(systems_that_memory_has_changed_are_refused), RUN(states_out_of_range_are_refused),
      RUN(systems_refuse_what_is_not_right), RUN(free_bodies_have_no_parent), RUN(work_means_nothing_between_calls),
      RUN(every_mode_is_within_its_range), RUN(no_input_is_an_input_of_zeros),
      RUN(the_check_word_of_a_system_sees_every_byte))
