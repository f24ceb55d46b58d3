/* >>system: bodies whose beams are lines (FB_EFFECT_LARGE_DEFLECTION) on joints: by either method and as loops, Hamilton's equations by
   differences, against single bodies and against the same beams cut finer. */
#include "system.h"

static const double stencil[5] = {1.0 / 12, -2.0 / 3, 0, 2.0 / 3, -1.0 / 12}; /* derivative of fourth order */
static fb_system_state rate, kept;

/* The tree of every kind of joint, its beams bent by some 20 % of their length. */
static void bent_tree(int damped)
{
  tree(FB_EFFECTS_LARGE, damped);
  for (int k = 0; k < desc.n_body; k++) {
    for (int a = 0; a < model[desc.model[k]].n; a++) {
      start[k].q[a] *= FB_R(5.0);
      start[k].q_dot[a] *= FB_R(5.0);
    }
  }
}

/* E9.4, E9.6, E9.8 with M(q), Lambda(q), M_rr(q) of E14.12, E9.25 by the rows: motors, loads, axes that are locked and
   prescribed, by elimination, one dense matrix and as loops; accelerations and reactions, then along a run. */
TEST(lines_move_alike_by_the_three_methods)
{
  static fb_system_motion first, recursive;
  double energy = 0.0;
  for (int form = 0; form < FORMS; form++) {
    bent_tree(1);
    drives();
    init(form);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    motion_of(&motion, &state);
    if (form == 0) {
      first = motion;
      energy = energy_of(&state);
    }
    FBT_BELOW(motion_difference(&motion, &first), FBT_TOL(1e-10, 1e-2));
    FBT_NEAR_REL(energy_of(&state), energy, FBT_TOL(1e-12, 1e-5));
    stepped(&state, FB_SINGLE ? 20 : 200, FB_SINGLE ? 2e-3 : 2e-4);
    motion_of(&motion, &state);
    if (form == 0) {
      recursive = motion;
    }
    FBT_BELOW(motion_difference(&motion, &recursive), FBT_TOL(1e-9, 2e-2));
  }
}

/* E9.25, E9.15, E14.13: along the rates the energy does not change and the momenta stay, by differences; a joint on a
   line whose Jacobian's rate were wrong would do work. */
TEST(rates_of_systems_with_lines_are_those_of_hamilton)
{
  for (int form = 0; form < FORMS && !FB_SINGLE; form++) { /* differences */
    const double h = 5e-5;
    double slope = 0.0;
    fb_momentum at, before;
    bent_tree(0);
    init(form);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    memset(&rate, 0, sizeof rate);
    FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, &input), FB_OK);
    FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &before, &state, &input), FB_OK);
    for (int side = -2; side <= 2; side++) {
      moved(&kept, &state, &rate, side * h);
      slope += stencil[side + 2] / h * energy_of(&kept);
      FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &at, &kept, &input), FB_OK);
      if (form != AS_LOOPS) {
        FBT_BELOW(fbt_difference(at.linear, before.linear, 3), 1e-12);
      }
    }
    FBT_NEAR_ABS(slope, 0.0, 3e-8);
  }
}

/* E9.19, E14.16 in a system: accelerations of bodies, modes and joints are the rates of the velocities along the
   rates. */
TEST(accelerations_of_systems_with_lines_are_rates)
{
  static fb_system_motion at, side;
  const double h = FBT_TOL(1e-4, 1e-2);
  fb_real v_dot[FB_MAX_BODIES][3];
  double worst = 0.0, size = 0.0;
  bent_tree(1);
  drives();
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, &input), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &at, &state, &input), FB_OK);
  for (int k = 0; k < desc.n_body; k++) {
    memcpy(v_dot[k], fbt_v_dot(&at.motion[k]), sizeof v_dot[k]);
    size = fmax(size, fbt_largest(at.motion[k].q_ddot, model[desc.model[k]].n));
  }
  for (int s = -2; s <= 2; s++) {
    fb_system_input moving = input;
    for (int k = 1; k < 3; k++) {
      moving.drive[k].rate[k - 1] += (fb_real)(s * h) * moving.drive[k].acceleration[k - 1];
    }
    moved(&kept, &state, &rate, s * h);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &side, &kept, &moving), FB_OK);
    for (int k = 0; k < desc.n_body; k++) {
      for (int i = 0; i < 3; i++) {
        v_dot[k][i] -= (fb_real)(stencil[s + 2] / h) * side.motion[k].v[i];
        at.motion[k].w_dot[i] -= (fb_real)(stencil[s + 2] / h) * side.motion[k].w[i];
        at.joint[k].acceleration[i] -= (fb_real)(stencil[s + 2] / h) * side.joint[k].speed[i];
      }
      for (int a = 0; a < model[desc.model[k]].n; a++) {
        at.motion[k].q_ddot[a] -= (fb_real)(stencil[s + 2] / h) * side.motion[k].q_dot[a];
      }
    }
  }
  for (int k = 0; k < desc.n_body; k++) {
    worst = fmax(worst, fmax(fbt_largest(v_dot[k], 3), fbt_largest(at.motion[k].w_dot, 3)));
    worst = fmax(worst, fbt_largest(at.motion[k].q_ddot, model[desc.model[k]].n));
    worst = fmax(worst, fbt_largest(at.joint[k].acceleration, 3));
  }
  FBT_ZERO(worst, size, FBT_TOL(1e-9, 1e-3));
}

/* ---- lines of every kind */

static fb_join_work join_work;

enum {
  CLAMPED,
  PINNED,
  FLOATING,
  THICK,
  WELDED,
  ROOTS
}; /* the root of the line; with all that it may have; two lines */

static void boom_desc(fb_root root, double length)
{
  memset(&beam_desc, 0, sizeof beam_desc);
  beam_desc.root = root;
  beam_desc.length = (fb_real)length;
  beam_desc.n_element = 6;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = FB_R(0.8);
  beam_desc.station[0].EI_y = FB_R(3.0);
  beam_desc.station[0].EI_z = FB_R(2.0);
  beam_desc.station[0].GJ = FB_R(1.5);
  beam_desc.station[0].i_y = FB_R(0.004);
  beam_desc.station[0].i_z = FB_R(0.003);
}

/* The outer of two lines at an angle, on the end of the first, which is clamped: all their elements, then the lowest
   modes of both. */
static void welded_booms(fb_beam part[2], fb_modes joined[2])
{
  static fb_modes basis[2];
  static const fb_weld weld = {{0, 1}, {3, 0}};
  for (int k = 0; k < 2; k++) {
    fb_modes_desc keep;
    memset(&keep, 0, sizeof keep);
    keep.basis = FB_BASIS_ELEMENTS;
    keep.line_points = 13;
    keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = keep.count[FB_KIND_TORSION] = 1;
    boom_desc(k ? FB_ROOT_FREE : FB_ROOT_CLAMPED, 0.5);
    beam_desc.n_element = 3;
    beam_desc.position[0] = k ? FB_R(0.5) : FB_R(0.0);
    turn(beam_desc.attitude, 0.0, 0.0, k ? 1.0 : 0.0);
    beam_desc.station[0].EA = FB_R(2000.0);
    FBT_INT_EQ(fb_beam_init(&part[k], &beam_desc), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&basis[k], &modes_work, &part[k], &keep), FB_OK);
  }
  FBT_INT_EQ(joined_by(joined, &join_work, part, basis, 2, &weld, 1, 5, FB_R(0.0)), FB_OK);
}

/* A body with a hub and a boom of some kind, node 1 at its end, 2 between its points. */
static fb_base base = FB_BASE_PRESCRIBED; /* of boom */

static void boom(fb_body *body, int kind)
{
  static fb_beam part[2];
  static fb_modes joined[2];
  static const fb_root roots[ROOTS] = {FB_ROOT_CLAMPED, FB_ROOT_PINNED, FB_ROOT_FREE, FB_ROOT_CLAMPED, FB_ROOT_CLAMPED};
  const fb_real root[3] = {FB_R(0.1), FB_R(0.05), 0}, inertia[6] = {FB_R(0.03), FB_R(0.04), FB_R(0.05), 0, 0, 0};
  fb_modes_desc keep;
  int node;
  fb_body_desc d = body_desc;
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 2;
  keep.count[FB_KIND_TORSION] = 1;
  keep.count[FB_KIND_AXIAL] = kind == THICK;
  boom_desc(roots[kind], 1.0);
  if (kind == THICK) {
    turn(beam_desc.attitude, 0.5, -0.7, 1.1);
    beam_desc.position[0] = FB_R(0.2);
    beam_desc.position[1] = -FB_R(0.1);
    beam_desc.station[0].EA = FB_R(400.0);
    beam_desc.station[0].GA_y = beam_desc.station[0].GA_z = FB_R(100.0);
    beam_desc.station[0].mass_y = FB_R(0.02);
    beam_desc.station[0].tension_z = FB_R(0.01);
    beam_desc.n_lump = 1;
    beam_desc.lump[0].node = 4;
    beam_desc.lump[0].mass = FB_R(0.3);
    beam_desc.lump[0].center[1] = FB_R(0.05);
    beam_desc.lump[0].inertia[0] = beam_desc.lump[0].inertia[1] = beam_desc.lump[0].inertia[2] = FB_R(0.01);
  }
  if (kind == WELDED) {
    welded_booms(part, joined);
  } else {
    FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  }
  d.base = base;
  d.effects = FB_EFFECTS_LARGE;
  d.deflection_limit = FB_R(9.0);
  FBT_INT_EQ(fb_shape_init(&shape, kind == WELDED ? joined[0].n : modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(1.5), root, inertia), FB_OK);
  if (kind == WELDED) {
    FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &part[0], &joined[0]), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &part[0], &joined[0], FB_R(0.5)), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &part[1], &joined[1]), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &part[1], &joined[1], FB_R(0.37)), FB_OK);
  } else {
    FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, FB_R(1.0)), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, FB_R(0.43)), FB_OK);
  }
  FBT_INT_EQ(fb_body_init(body, &body_work, &shape, &d), FB_OK);
}

/* Three such bodies: the second on the node `at` of the first, the third on the end of the second. */
static void booms(int kind, fb_joint_kind first, fb_joint_kind joint, int at)
{
  fresh();
  boom(&model[0], kind);
  hang(0, 0, first, FB_GROUND, 0);
  hang(1, 0, joint, 0, at);
  hang(2, 0, FB_JOINT_UNIVERSAL, 1, 1);
  fbt_seed((unsigned)(17 + kind));
  for (int k = 0; k < 3; k++) {
    fb_joint_desc *j = &desc.joint[k];
    turn_anyhow(j->attitude, 1.0);
    turn_anyhow(j->child_attitude, 1.0);
    fbt_fill(j->position, 3, k ? 0.2 : 0.0);
    fbt_fill(j->child_position, 3, k ? 0.2 : 0.0);
    fbt_fill(start[k].value, 3, 0.4);
    j->pitch = FB_R(0.1);
    turn_anyhow(start[k].quat, 0.6);
    fbt_fill(start[k].speed, 6, 1.0);
    fbt_fill(start[k].q, model[0].n, kind == FLOATING ? 0.02 : 0.1);
    fbt_fill(start[k].q_dot, model[0].n, 0.6);
    for (int i = 0; i < 3 && (k || first != FB_JOINT_FREE); i++) {
      j->stiffness[i] = (fb_real)(2.0 + fbt_random());
    }
  }
}

/* E9.25, E9.12, E14.7 with lines of every kind and joints of every kind on them: along the rates the energy does not
   change, by differences. */
TEST(lines_of_every_kind_carry_their_bodies)
{
  const int kinds = (int)FB_JOINT_COUNT - (int)FB_JOINT_RIGID;
  for (int run = 0; run < kinds * ROOTS && !FB_SINGLE; run++) { /* differences */
    const double h = 2e-5;
    double slope = 0.0, power = 0.0;
    booms(run / kinds, run % 2 ? FB_JOINT_FREE : FB_JOINT_REVOLUTE, (fb_joint_kind)((int)FB_JOINT_RIGID + run % kinds),
          1 + run % 2);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    memset(&rate, 0, sizeof rate);
    FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, &input), FB_OK);
    for (int side = -2; side <= 2; side++) {
      moved(&kept, &state, &rate, side * h);
      slope += stencil[side + 2] / h * energy_of(&kept);
    }
    for (int k = 0; k < 3; k++) {
      for (int a = 0; a < model[0].n; a++) {
        power += fabs((double)(rate.link[k].pi[a] * rate.link[k].q[a]));
      }
    }
    FBT_BELOW(fabs(slope) / power, 1e-9);
  }
}

/* E9.16, E9.5: the speeds that made the momenta come back, momenta of all forms are the same. */
TEST(momenta_of_lines_give_back_the_speeds)
{
  for (int form = 0; form < FORMS; form++) {
    fb_real speed[2];
    booms(THICK, FB_JOINT_FREE, FB_JOINT_SPHERICAL, 2);
    memcpy(speed, start[2].speed, sizeof speed);
    init(form);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    motion_of(&motion, &state);
    for (int k = 0; k < 3; k++) {
      FBT_BELOW(fbt_difference(motion.motion[k].q_dot, start[k].q_dot, model[0].n), FBT_TOL(1e-11, 1e-3));
    }
    FBT_BELOW(fbt_difference(motion.joint[2].speed, speed, 2), FBT_TOL(1e-11, 1e-3));
  }
}

/* ---- against single bodies */

/* Distributed loads that depend on all that a point knows; user: their power and the bodies that were asked. */
typedef struct gale {
  double power;
  unsigned bodies;
  int calls, fails; /* the call that fails: with a status, < 0: by a force that is no number */
} gale;

static fb_status blow(fb_line_point *p, int n, fb_real t, void *user)
{
  gale *const own = (gale *)user;
  own->bodies |= 1u << p[0].body;
  for (int k = 0; k < n; k++) {
    for (int i = 0; i < 3; i++) {
      const double x = (double)p[k].x, r = (double)p[k].position[i], v = (double)p[k].velocity[i];
      const double w = (double)p[k].angular_rate[i], R = (double)p[k].R[3 * i + 1];
      p[k].force[i] = p[k].length *
                      (fb_real)(sin(1.0 + i + 3.0 * x + 20.0 * (double)t) - 0.8 * v - 0.5 * r + (1.0 + p[k].line) * R);
      p[k].torque[i] = p[k].length * (fb_real)(0.1 * cos(2.0 - i + x) - 0.05 * w);
    }
    own->power += (double)fb_vec3_dot(p[k].force, p[k].velocity) + (double)fb_vec3_dot(p[k].torque, p[k].angular_rate);
  }
  if (own->fails && ++own->calls == abs(own->fails)) {
    p[n - 1].torque[1] = own->fails < 0 ? (fb_real)NAN : FB_R(0.0);
    return own->fails < 0 ? FB_OK : FB_ERR_CONVERGENCE;
  }
  return FB_OK;
}

/* E9.15, E11.12, E14.40 against E14.13, E11.1: one body in free flight, as a system and by itself, without and with
   distributed loads. */
TEST(a_line_alone_is_the_single_body)
{
  static fb_rk4_work rk4_work;
  for (int run = 0; run < 2 * ROOTS; run++) {
    const int kind = run / 2;
    static fb_input own[3];
    static fb_system_input at[3];
    static gale gales;
    fb_state single;
    fb_motion alone;
    fb_real v[3], w[3];
    fresh();
    base = FB_BASE_FREE;
    boom(&model[0], kind);
    base = FB_BASE_PRESCRIBED;
    hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
    fbt_seed(3);
    turn_anyhow(start[0].quat, 0.6);
    fbt_fill(start[0].speed, 6, 1.0);
    fbt_fill(start[0].q, model[0].n, 0.02);
    fbt_fill(start[0].q_dot, model[0].n, 0.8);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_state_init(&model[0], &single), FB_OK);
    memcpy(single.quat, start[0].quat, sizeof single.quat);
    memcpy(single.q, start[0].q, sizeof start[0].q);
    memcpy(v, start[0].speed, sizeof v);
    memcpy(w, start[0].speed + 3, sizeof w);
    memset(single.rho, 0, sizeof single.rho);
    FBT_INT_EQ(fb_state_from_velocity(&model[0], &single, v, w, start[0].q_dot), FB_OK);
    for (int step = 0; step < 100; step++) {
      const fb_real dt = FBT_TOL(FB_R(5e-5), FB_R(4e-4));
      for (int i = 0; i < 3; i++) {
        memset(&own[i], 0, sizeof own[i]);
        at[i] = input;
        at[i].distributed = own[i].distributed = run % 2 ? blow : NULL;
        at[i].user = own[i].user = &gales;
        at[i].t = own[i].t = dt * ((fb_real)step + FB_R(0.5) * (fb_real)i);
      }
      FBT_INT_EQ(fb_rk4_step(&model[0], &single, &rk4_work, &own[0], &own[1], &own[2], dt), FB_OK);
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &at[0], &at[1], &at[2], dt), FB_OK);
    }
    FBT_INT_EQ(fb_body_motion_eval(&model[0], &alone, &single, &own[2]), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &at[2]), FB_OK);
    FBT_BELOW(fbt_difference(single.rho, motion.pose[0].rho, 3), FBT_TOL(1e-10, 1e-3));
    FBT_BELOW(fbt_difference(single.q, state.link[0].q, model[0].n), FBT_TOL(1e-10, 1e-3));
    FBT_BELOW(fbt_difference(alone.w, motion.motion[0].w, 3), FBT_TOL(1e-10, 1e-2));
    FBT_BELOW(fbt_difference(alone.q_dot, motion.motion[0].q_dot, model[0].n), FBT_TOL(1e-9, 1e-2));
    FBT_BELOW(fbt_difference(alone.w_dot, motion.motion[0].w_dot, 3), FBT_TOL(1e-8, 1e-2));
    FBT_ZERO(fbt_difference(alone.q_ddot, motion.motion[0].q_ddot, model[0].n), fbt_largest(alone.q_ddot, model[0].n),
             FBT_TOL(1e-9, 1e-3));
  }
}

/* ---- distributed loads */

/* E14.40 in a system: what the loads on all points do is the rate of the energy, by differences; each body is asked.
   In every form, accelerations are the same. */
TEST(power_of_distributed_loads_on_systems_is_the_rate_of_energy)
{
  static fb_system_motion first;
  for (int run = 0; run < FORMS * ROOTS; run++) {
    const double h = 2e-5;
    double slope = 0.0;
    gale gales;
    if (run / 3 == FLOATING && run % 3 == AS_LOOPS) {
      continue;
    }
    booms(run / 3, FB_JOINT_FREE, FB_JOINT_UNIVERSAL, 2);
    input.distributed = blow;
    memset(&gales, 0, sizeof gales);
    input.user = &gales;
    input.t = FB_R(0.1);
    init(run % 3);
    memset(&gales, 0, sizeof gales);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, &input), FB_OK);
    FBT_INT_EQ((int)gales.bodies, 7);
    for (int side = -2; side <= 2; side++) {
      moved(&kept, &state, &rate, side * h);
      slope += stencil[side + 2] / h * energy_of(&kept);
    }
    FBT_DOUBLE_ONLY("differences")
    {
      FBT_NEAR_REL(slope, gales.power, 1e-7);
    }
    motion_of(&motion, &state);
    first = run % 3 ? first : motion;
    FBT_BELOW(motion_difference(&motion, &first), FBT_TOL(1e-9, 1e-1));
  }
}

/* Interface: a callback that fails ends the step, which changes nothing; loads on lines of bodies without lines are
   refused. */
TEST(systems_refuse_distributed_loads_that_fail)
{
  gale gales;
  for (int run = 0; run < 4; run++) {
    memset(&gales, 0, sizeof gales);
    gales.fails = run % 2 ? -5 : 5;
    booms(CLAMPED, FB_JOINT_FREE, FB_JOINT_REVOLUTE, 1);
    input.distributed = blow;
    input.user = &gales;
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    kept = state;
    FBT_INT_EQ(run < 2 ? fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(1e-4))
                       : fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, FB_R(1e-4), 2),
               run % 2 ? FB_ERR_NOT_FINITE : FB_ERR_CONVERGENCE);
    FBT_TRUE(memcmp(&kept, &state, sizeof state) == 0);
  }
  gales.calls = 4;
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_ERR_NOT_FINITE);
  fresh();
  flexible(&model[0], 1, 1, 0, FB_EFFECTS_FULL);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  input.distributed = blow;
  input.user = &gales;
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
  FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(1e-4)),
             FB_ERR_UNSUPPORTED);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_ERR_UNSUPPORTED);
}

/* ---- energy, momentum, latches */

/* E11.12: the energy less the work of motors, and its order when the step is halved; momenta of a free tree. */
TEST(systems_with_lines_keep_energy_and_momentum)
{
  double change[3];
  for (int run = 0; run < 3; run++) {
    const int n = 100 << run;
    double before;
    fb_momentum first, last;
    booms(CLAMPED, FB_JOINT_FREE, FB_JOINT_REVOLUTE, 1);
    input.drive[1].torque[0] = FB_R(0.3);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    before = energy_of(&state);
    FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &first, &state, &input), FB_OK);
    for (int k = 0; k < n; k++) {
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, (fb_real)(0.1 / n)),
                 FB_OK);
    }
    change[run] = fabs((energy_of(&state) - (double)state.motor_work) / before - 1.0);
    FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &last, &state, &input), FB_OK);
    FBT_BELOW(fbt_difference(first.linear, last.linear, 3), FBT_TOL(1e-12, 1e-4));
    FBT_BELOW(fbt_difference(first.angular, last.angular, 3), FBT_TOL(change[run] + 1e-12, 1e-3));
  }
  FBT_BELOW(change[2], FBT_TOL(1e-9, 1e-4));
  FBT_TRUE(FB_SINGLE || (change[0] > 12.0 * change[1] && change[1] > 14.0 * change[2]));
}

/* E9.16, E14.12: locking the axes of a moving tree keeps its momenta and loses energy; to release costs nothing. */
TEST(a_latch_on_a_line_conserves_momentum)
{
  for (int form = 0; form < FORMS; form += AS_LOOPS) {
    fb_momentum before, after;
    double energy;
    booms(CLAMPED, FB_JOINT_FREE, FB_JOINT_REVOLUTE, 1);
    for (int k = 1; k < 3; k++) {
      memset(desc.joint[k].stiffness, 0, sizeof desc.joint[k].stiffness);
    }
    init(form);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &before, &state, &input), FB_OK);
    energy = energy_of(&state);
    for (int joint = 1; joint < 3; joint++) {
      FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &state, &work, joint_at[joint], 0, FB_AXIS_LOCKED, &input),
                 FB_OK);
      FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &after, &state, &input), FB_OK);
      FBT_BELOW(fbt_difference(after.linear, before.linear, 3), FBT_TOL(1e-12, 1e-4));
      FBT_BELOW(fbt_difference(after.angular, before.angular, 3), FBT_TOL(1e-12, 1e-4));
      FBT_BELOW(energy_of(&state), energy);
      energy = energy_of(&state);
    }
    for (int k = 0; k < 100; k++) {
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(2e-4)), FB_OK);
    }
    motion_of(&motion, &state);
    for (int joint = 1; joint < 3; joint++) {
      FBT_NEAR_ABS(motion.joint[joint].speed[0], 0.0, FBT_TOL(1e-11, 1e-3));
      FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &state, &work, joint_at[joint], 0, FB_AXIS_FREE, &input), FB_OK);
    }
    FBT_NEAR_REL(energy_of(&state), energy, FBT_TOL(1e-8, 1e-3));
    FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &after, &state, &input), FB_OK);
    FBT_BELOW(fbt_difference(after.angular, before.angular, 3), FBT_TOL(1e-8, 1e-3));
  }
}

/* E11.14 with M(q) and Lambda(q) of each stage in its iteration matrix: order 2, against rk4 with short steps. */
TEST(sdirk_with_lines_converges_to_rk4)
{
  static fb_system_state fine;
  double error[3] = {0.0, 0.0, 0.0};
  for (int run = 0; run < 3 && !FB_SINGLE; run++) { /* differences of 1e-7 */
    const int n = run ? 100 << run : 2000;
    booms(CLAMPED, FB_JOINT_FREE, FB_JOINT_REVOLUTE, 1);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    for (int k = 0; k < n; k++) {
      const fb_real dt = (fb_real)(0.05 / n);
      FBT_INT_EQ(run ? fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, dt, 3)
                     : fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, dt),
                 FB_OK);
    }
    fine = run ? fine : state;
    for (int k = 0; k < 3; k++) {
      error[run] = fmax(error[run], fbt_difference(fine.link[k].q, state.link[k].q, model[0].n));
    }
  }
  FBT_BELOW(error[2], 1e-6);
  FBT_TRUE(FB_SINGLE || error[1] > 3.9 * error[2]);
}

/* ---- step limits */

/* Links of 3 + 3 modes on a light hub that flies free, hinges between them, at random shapes of some size. */
static void light_chain(int links, double hub, int sprung, double size)
{
  const fb_real root[3] = {0},
                inertia[6] = {(fb_real)(0.25 * hub), (fb_real)(0.25 * hub), (fb_real)(0.25 * hub), 0, 0, 0};
  fb_modes_desc keep;
  int node;
  fresh();
  memset(&keep, 0, sizeof keep);
  boom_desc(FB_ROOT_CLAMPED, 10.0);
  beam_desc.n_element = 10;
  beam_desc.station[0].EI_y = beam_desc.station[0].EI_z = FB_R(14000.0);
  beam_desc.station[0].mass = FB_R(1.2);
  beam_desc.station[0].i_y = beam_desc.station[0].i_z = beam_desc.station[0].GJ = FB_R(0.0);
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 3;
  body_desc.base = FB_BASE_PRESCRIBED;
  body_desc.effects = FB_EFFECTS_LARGE;
  body_desc.deflection_limit = FB_R(1000.0);
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)hub, root, inertia), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, FB_R(10.0)), FB_OK);
  FBT_INT_EQ(fb_body_init(&model[0], &body_work, &shape, &body_desc), FB_OK);
  for (int k = 0; k < links; k++) {
    hang(k, 0, k ? FB_JOINT_REVOLUTE : FB_JOINT_FREE, k - 1, k > 0);
    desc.joint[k].stiffness[0] = k && sprung ? FB_R(3000.0) : FB_R(0.0);
    start[k].value[0] = k ? (fb_real)fbt_random() : FB_R(0.0);
    for (int a = 0; a < 6; a++) {
      start[k].q[a] = (fb_real)(6.0 * size * fbt_random() / (1.0 + 4.0 * (a % 3) * (a % 3)));
    }
  }
}

/* Twice the kinetic energy with unit speed i and sign times unit speed j: of the modes, then of the joint, by bodies. */
static double twice_energy(int i, int j, double sign)
{
  static fb_system_state moving;
  fb_link_motion speeds[FB_MAX_BODIES];
  fb_energy e;
  memcpy(speeds, start, sizeof speeds);
  for (int k = 0, c = 0; k < desc.n_body; k++) {
    for (int a = 0; a < 6 + (k ? 1 : 6); a++, c++) {
      *(a < 6 ? &speeds[k].q_dot[a] : &speeds[k].speed[a - 6]) = (fb_real)((c == i) + sign * (c == j));
    }
  }
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &moving, &work, speeds, NULL), FB_OK);
  FBT_INT_EQ(fb_system_energy_eval(&mechanism, model, &work, &e, &moving, NULL), FB_OK);
  return 2.0 * (double)e.kinetic;
}

/* Highest frequency of the chain as it is bent, by its mass matrix from energies. */
static double chain_frequency(void)
{
  static fb_real M[FB_MAX_SPEEDS * FB_MAX_SPEEDS], K[FB_MAX_SPEEDS * FB_MAX_SPEEDS], X[FB_MAX_SPEEDS * FB_MAX_SPEEDS];
  static fb_real d[FB_MAX_SPEEDS];
  const int N = 7 * desc.n_body + 5;
  memset(K, 0, sizeof K);
  for (int k = 0, c = 0; k < desc.n_body; k++) {
    for (int a = 0; a < 6 + (k ? 1 : 6); a++, c++) {
      K[c * (N + 1)] = a < 6 ? model[0].K.diagonal[a] : k ? desc.joint[k].stiffness[0] : FB_R(0.0);
    }
  }
  for (int i = 0; i < N; i++) {
    for (int j = 0; j <= i; j++) {
      M[i * N + j] = M[j * N + i] =
          (fb_real)(i == j ? twice_energy(i, i, 0.0) : 0.25 * (twice_energy(i, j, 1.0) - twice_energy(i, j, -1.0)));
    }
  }
  FBT_INT_EQ(fb_eig_gen_solve(d, X, K, M, N), FB_OK);
  return sqrt((double)d[N - 1]);
}

/* Longest step that rk4 takes from the state, up to `most`. */
static double longest_step(double most)
{
  double least = 0.0;
  for (int i = 0; i < 20; i++) {
    const double dt = 0.5 * (least + most);
    kept = state;
    if (fb_system_rk4_step(&mechanism, model, &kept, &work, &input, &input, &input, (fb_real)dt) == FB_OK) {
      least = dt;
    } else {
      most = dt;
    }
  }
  return least;
}

/* E11.40: no step is taken that is beyond the limit of stability of the bent chain, up to a percent, though the limit of
   the undeformed one is up to four times as long; nearly all of it is where nothing turns. */
TEST(systems_refuse_steps_that_a_bent_line_does_not_allow)
{
  double least = HUGE_VAL, longer = 0.0;
  fbt_seed(11);
  for (int run = 0; run < 24 && !FB_SINGLE; run++) { /* differences of energies */
    const double size = 0.5 * (run / 2 % 4);
    double limit, frequency, longest;
    light_chain(1 + run / 8, run % 2 ? 2.5 : 0.1, run / 4 % 2, size);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    limit = (double)fb_system_rk4_limit(&mechanism, model, 0, 0);
    frequency = chain_frequency();
    longest = longest_step(4.0 * limit);
    FBT_BELOW(longest * frequency, 1.01 * 2.785);
    longer = fmax(longer, limit * frequency / 2.785);
    least = size > 0.0 ? least : fmin(least, longest * frequency / 2.785);
  }
  FBT_TRUE(FB_SINGLE || (longer > 2.0 && least > 0.9));
}

/* E11.40: modes of polynomials beside bent lines count by their own speeds in the power method, not by those of the
   motion: by elimination, which does not ask for them else, and by one dense matrix. */
TEST(the_bound_of_bent_lines_has_the_modes_of_other_bodies)
{
  for (int fast = 0; fast < 2; fast++) {
    static fb_system_limit by[2];
    for (int method = 0; method < 2; method++) {
      fbt_seed(11);
      light_chain(1, 0.1, 0, 1.5);
      flexible(&model[1], 1, 1, 0, FB_EFFECTS_FULL);
      hang(1, 1, FB_JOINT_REVOLUTE, 0, 1);
      start[1].q_dot[0] = (fb_real)(3 * fast);
      init(method ? FB_METHOD_DENSE : FB_METHOD_RECURSIVE);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
      FBT_INT_EQ(fb_system_limit_eval(&mechanism, model, &work, &by[method], &state, &input), FB_OK);
    }
    FBT_NEAR_REL(by[1].rk4, by[0].rk4, FBT_TOL(1e-9, 1e-3));
    FBT_BELOW(by[0].rk4, 0.9 * (double)fb_system_rk4_limit(&mechanism, model, 0, 0)); /* the deflection counts */
  }
}

SUITE(system_lines, RUN_LONG(sdirk_with_lines_converges_to_rk4), RUN(lines_move_alike_by_the_three_methods),
      RUN(rates_of_systems_with_lines_are_those_of_hamilton), RUN(accelerations_of_systems_with_lines_are_rates),
      RUN(lines_of_every_kind_carry_their_bodies), RUN(momenta_of_lines_give_back_the_speeds),
      RUN(a_line_alone_is_the_single_body), RUN(systems_with_lines_keep_energy_and_momentum),
      RUN(a_latch_on_a_line_conserves_momentum), RUN(power_of_distributed_loads_on_systems_is_the_rate_of_energy),
      RUN(systems_refuse_distributed_loads_that_fail), RUN_LONG(systems_refuse_steps_that_a_bent_line_does_not_allow),
      RUN(the_bound_of_bent_lines_has_the_modes_of_other_bodies))
