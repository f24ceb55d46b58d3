/* >>system: trees of bodies: energy, momentum and accelerations, the same by every method and in any unit. */
#include "system.h"

static fb_system_state kept, rate;

/* E9.14, E9.12, E9.15: along the rates of a tree in free motion the energy, the momentum and the angular momentum about
   the inertial origin do not change, for every set of effects that is whole. */
TEST(systems_keep_energy_and_momentum)
{
  static const unsigned sets[] = {FB_EFFECTS_FULL, FB_EFFECTS_SPIN, FB_EFFECTS_LINEAR, FB_EFFECTS_RIGID};
  for (int run = 0; run < 8; run++) {
    const double h = FBT_TOL(1e-4, 1e-2);
    double slope = 0.0;
    fb_momentum at, before;
    tree(sets[run / 2], 0);
    init(run % 2 ? FB_METHOD_DENSE : FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    memset(&rate, 0, sizeof rate);
    FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, &input), FB_OK);
    FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &before, &state, &input), FB_OK);
    for (int side = -2; side <= 2; side++) {
      static const double weight[5] = {1.0 / 12, -2.0 / 3, 0, 2.0 / 3, -1.0 / 12};
      moved(&kept, &state, &rate, side * h);
      slope += weight[side + 2] / h * energy_of(&kept);
      FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &at, &kept, &input), FB_OK);
      FBT_BELOW(fbt_difference(at.linear, before.linear, 3), FBT_TOL(1e-13, 1e-4) * 10.0);
    }
    FBT_NEAR_ABS(slope, 0.0, FBT_TOL(1e-9, 1e-1));
  }
}

/* E9.3 to E9.10, E9.13, E9.15, E9.19: joint coordinates by recursion and by one dense matrix, and every body free with
   the joints as loops, give the same positions, velocities, accelerations, joint forces and energy: at one instant to
   rounding, after a while to 1e-9 (with loops other coordinates, with an error of the same order). */
TEST(the_three_methods_agree)
{
  static fb_system_motion recursive, first;
  for (int run = 0; run < 2; run++) {
    double energy = 0.0;
    for (int form = 0; form < FORMS; form++) {
      tree(run ? FB_EFFECTS_SPIN : FB_EFFECTS_FULL, 1);
      drives();
      init(form);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
      motion_of(&motion, &state);
      if (form == 0) {
        first = motion;
        energy = energy_of(&state);
      }
      FBT_BELOW(motion_difference(&motion, &first), FBT_TOL(1e-11, 1e-3));
      FBT_NEAR_REL(energy_of(&state), energy, FBT_TOL(1e-12, 1e-5));
      stepped(&state, FB_SINGLE ? 20 : 200, FB_SINGLE ? 2e-3 : 2e-4);
      motion_of(&motion, &state);
      if (form == 0) {
        recursive = motion;
      }
      FBT_BELOW(motion_difference(&motion, &recursive), FBT_TOL(1e-9, 1e-2));
    }
  }
}

/* Component i of an inertial vector in the axes of an attitude. */
static double turned_back(const fb_real quat[4], const double x[3], int i)
{
  const fb_real inertial[3] = {(fb_real)x[0], (fb_real)x[1], (fb_real)x[2]};
  fb_real R[9], own[3];
  fb_quat_to_mat33(R, quat);
  fb_mat33_mulT_vec3(own, R, inertial);
  return (double)own[i];
}

/* What of a motion the speed of flight must not change: joints, modes, attitudes; by the first, as a difference. */
static double flight_difference(const fb_system_motion *a, const fb_system_motion *b)
{
  double worst = 0.0;
  for (int k = 0; k < desc.n_body; k++) {
    const fb_real back[4] = {b->pose[k].quat[0], -b->pose[k].quat[1], -b->pose[k].quat[2], -b->pose[k].quat[3]};
    fb_real turned[4], phi[3];
    fb_quat_mul(turned, a->pose[k].quat, back);
    fb_quat_to_rotvec(phi, turned);
    worst = fmax(worst, fbt_largest(phi, 3));
    worst = fmax(worst, fbt_difference(a->pose[k].q, b->pose[k].q, model[desc.model[k]].n));
    worst = fmax(worst, k ? fbt_difference(a->joint[k].value, b->joint[k].value, 3) : 0.0);
  }
  return worst;
}

/* A loop in single precision multiplies the rounding of every step, whatever the speed. */
static int flight_steps(int loop)
{
  return loop ? 20 : 60;
}

/* The tree that tree() makes, pushed in all axes, with a loop or without, from its start at a speed along an inertial
   direction; its motion after a while. */
static void fly(fb_system_motion *out, int form, int integrator, int loop, double speed)
{
  const fb_real U[3] = {(fb_real)(speed / 3.0), (fb_real)(2.0 * speed / 3.0), -(fb_real)(2.0 * speed / 3.0)};
  fb_real R[9], u[3];
  tree(FB_EFFECTS_FULL, 1);
  input.n_load = 3;
  for (int i = 0; i < 3; i++) {
    input.load[i].body = i;
    input.load[i].load.node = 1;
    input.load[i].load.axes = (fb_axes)i;
    input.load[i].load.force[i] = FB_R(2.0);
    input.load[i].load.torque[2 - i] = FB_R(0.1);
  }
  if (loop) { /* the hub and a body four joints away, by a ball joint where it is */
    fb_joint_desc *j = &desc.loop[0];
    fb_real away[3];
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, out, &state, &input), FB_OK);
    desc.n_loop = 1;
    j->kind = FB_JOINT_SPHERICAL;
    j->child = 6;
    fb_quat_to_mat33(R, out->pose[0].quat);
    for (int i = 0; i < 3; i++) {
      away[i] = out->pose[6].rho[i] - out->pose[0].rho[i];
    }
    fb_mat33_mulT_vec3(j->position, R, away);
  }
  fb_quat_to_mat33(R, start[0].quat);
  fb_mat33_mulT_vec3(u, R, U);
  for (int i = 0; i < 3; i++) {
    start[0].speed[i] = u[i] + (fb_real)0.25 * (fb_real)(1 + i);
  }
  init(form);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  for (int step = 0; step < flight_steps(loop); step++) {
    FBT_INT_EQ(integrator ? fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, FB_R(2e-3), 3)
                          : fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(2e-3)),
               FB_OK);
  }
  FBT_INT_EQ(fb_system_state_check(&mechanism, model, &state), FB_OK);
  motion_of(out, &state);
}

/* E9.21 to E9.24, E11.23: a system that flies at up to 30 km/s, pushed on the way, moves as the one that does not, in
   every form by every integrator, with a loop and without (the equations are invariant, the arithmetic must be). */
TEST(flight_speed_changes_nothing)
{
  static const double speed[] = {100.0, 250.0, 7500.0, 30000.0};
  static fb_system_motion rest;
  /* single precision: speeds that free bodies are given at 30 km/s do not tell how they move by each other */
  for (int run = 0; run < (FB_SINGLE ? 8 : 12); run++) {
    const int form = run / 4, integrator = run / 2 % 2, loop = run % 2;
    fly(&rest, form, integrator, loop, 0.0);
    for (int k = 0; k < FBT_COUNT(speed); k++) {
      const double time = 2e-3 * flight_steps(loop);
      double far = 0.0;
      fly(&motion, form, integrator, loop, speed[k]);
      FBT_BELOW(flight_difference(&motion, &rest), FBT_TOL(1e-9, 2e-5));
      for (int i = 0; i < 3; i++) { /* and gets where it should */
        const double U[3] = {speed[k] / 3.0, 2.0 * speed[k] / 3.0, -2.0 * speed[k] / 3.0};
        far = fmax(far, fabs((double)(motion.pose[0].rho[i] - rest.pose[0].rho[i]) - time * U[i]));
        FBT_NEAR_ABS(motion.motion[0].v[i] - rest.motion[0].v[i], turned_back(motion.pose[0].quat, U, i),
                     FBT_TOL(1e-9, 2e-5) * (1.0 + speed[k]));
      }
      FBT_BELOW(far, FBT_TOL(1e-9, 2e-5) + 8.0 * (double)FB_EPSILON * time * speed[k]);
    }
  }
}

/* E9.21, E9.22: a root that is driven at a constant velocity, then let go: all that hangs on it moves as if it
   had been at rest; the frame of a locked one stands still. */
TEST(driven_roots_fly_as_they_stand)
{
  static fb_system_motion rest;
  for (int run = 0; run < 4; run++) {
    const int integrator = run / 2, fast = run % 2;
    fb_real R[9];
    const fb_real U[3] = {FB_R(2500.0) * (fb_real)fast, -FB_R(5000.0) * (fb_real)fast, FB_R(5000.0) * (fb_real)fast};
    tree(FB_EFFECTS_FULL, 1);
    desc.joint[0].mode[0] = FB_AXIS_PRESCRIBED;
    init(FB_METHOD_RECURSIVE);
    fb_quat_to_mat33(R, start[0].quat);
    fb_mat33_mulT_vec3(input.drive[0].rate, R, U);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    for (int step = 0; step < 40; step++) {
      FBT_INT_EQ(step == 20 ? fb_system_axis_set(&mechanism, model, &state, &work, 0, 0, FB_AXIS_FREE, &input) : FB_OK,
                 FB_OK);
      FBT_INT_EQ(integrator ? fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, FB_R(2e-3), 3)
                            : fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(2e-3)),
                 FB_OK);
    }
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, fast ? &motion : &rest, &state, &input), FB_OK);
    FBT_BELOW(fast ? flight_difference(&motion, &rest) : 0.0, FBT_TOL(1e-9, 2e-5));
    FBT_TRUE(!fast || fbt_largest(state.link[0].u, 3) > 4000.0);
    FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &state, &work, 0, 0, FB_AXIS_LOCKED, &input), FB_OK);
    FBT_TRUE(fbt_largest(state.link[0].u, 3) == 0.0);
  }
}

/* E11.23: momentum and angular momentum about the inertial origin of a free tree in fast flight far from that origin
   are those of the start, to rounding. */
TEST(fast_systems_keep_their_angular_momentum)
{
  for (int integrator = 0; integrator < 2; integrator++) {
    fb_momentum first, now;
    tree(FB_EFFECTS_FULL, 0);
    init(FB_METHOD_RECURSIVE);
    start[0].value[1] = FB_R(5000.0);
    start[0].speed[0] += FB_R(30000.0);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &first, &state, NULL), FB_OK);
    for (int step = 0; step < 200; step++) {
      FBT_INT_EQ(integrator ? fb_system_sdirk_step(&mechanism, model, &state, &work, NULL, NULL, FB_R(1e-3), 0)
                            : fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, FB_R(1e-3)),
                 FB_OK);
    }
    FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &now, &state, NULL), FB_OK);
    FBT_BELOW(fbt_difference(now.linear, first.linear, 3), 4.0 * (double)FB_EPSILON * fbt_largest(first.linear, 3));
    FBT_BELOW(fbt_difference(now.angular, first.angular, 3), 32.0 * (double)FB_EPSILON * fbt_largest(first.angular, 3));
  }
}

/* E9.21: every set of effects keeps the momenta of what flies and spins, in small steps to the error of the
   integrator. */
TEST(every_set_keeps_the_momenta_of_free_systems)
{
  static const unsigned sets[] = {FB_EFFECTS_LINEAR, FB_EFFECTS_SPIN, FB_EFFECTS_FULL};
  for (int run = 0; run < 6; run++) {
    fb_momentum first, now;
    tree(sets[run / 2], 0);
    init(FB_METHOD_RECURSIVE);
    start[0].speed[0] += run % 2 ? FB_R(10.0) : FB_R(0.0);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &first, &state, NULL), FB_OK);
    for (int step = 0; step < 500; step++) {
      FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, FB_R(1e-3)), FB_OK);
    }
    FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &now, &state, NULL), FB_OK);
    FBT_BELOW(fbt_difference(now.linear, first.linear, 3), FBT_TOL(1e-12, 1e-5) * fbt_largest(first.linear, 3));
    FBT_BELOW(fbt_difference(now.angular, first.angular, 3), FBT_TOL(1e-9, 1e-5) * fbt_largest(first.linear, 3));
  }
}

/* Particles with as many modes and nodes as there can be; all modes move and turn all nodes. */
static void crowded(fb_body *body)
{
  const int n = FB_MAX_MODES;
  fb_body_desc d = body_desc;
  fb_real r[3], psi[3 * FB_MAX_MODES], theta[3 * FB_MAX_MODES];
  int node;
  d.base = FB_BASE_PRESCRIBED;
  d.effects |= FB_EFFECTS_SPIN;
  d.deflection_limit = FB_R(10.0);
  FBT_INT_EQ(fb_shape_init(&shape, n), FB_OK);
  for (int k = 0; k < 2 * n; k++) {
    fbt_fill(r, 3, 1.0);
    fbt_fill(psi, 3 * n, 0.2);
    FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(0.3), r, psi, NULL), FB_OK);
  }
  for (int a = 0; a < n; a++) {
    shape.K[a * (n + 1)] = (fb_real)(5.0 + a);
  }
  for (int k = 1; k < FB_MAX_NODES; k++) {
    fbt_fill(r, 3, 1.0);
    fbt_fill(psi, 3 * n, 0.2);
    fbt_fill(theta, 3 * n, 0.2);
    FBT_INT_EQ(fb_shape_add_node(&shape, &node, r, psi, theta), FB_OK);
  }
  FBT_INT_EQ(fb_body_init(body, &body_work, &shape, &d), FB_OK);
}

/* E9.3 to E9.6, E9.10, E9.19: bodies with as many modes as there can be, on each other's nodes, by each method. */
TEST(methods_agree_on_as_many_modes_as_there_can_be)
{
  static fb_system_motion first;
  fresh();
  fbt_seed(13);
  crowded(&model[0]);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  hang(1, 0, FB_JOINT_UNIVERSAL, 0, 1);
  for (int k = 0; k < 2; k++) {
    fbt_fill(start[k].speed, k ? 2 : 6, 0.5);
    fbt_fill(start[k].q, model[0].n, 0.05);
    fbt_fill(start[k].q_dot, model[0].n, 0.2);
    start[k].value[0] = FB_R(0.3);
  }
  for (int form = 0; form < FORMS; form++) {
    init(form);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    motion_of(form ? &motion : &first, &state);
    FBT_BELOW(form ? motion_difference(&motion, &first) : 0.0, FBT_TOL(1e-10, 1e-2));
  }
}

/* E9.18, E9.19: accelerations are the rates of the velocities along the rates of the state, for all bodies, modes and
   joints, with motors, loads and prescribed axes. */
TEST(accelerations_are_the_rates_of_velocities)
{
  static fb_system_motion at, side;
  const double h = FBT_TOL(1e-4, 1e-2);
  fb_real v_dot[FB_MAX_BODIES][3];
  double worst = 0.0;
  tree(FB_EFFECTS_FULL, 1);
  drives();
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, &input), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &at, &state, &input), FB_OK);
  for (int k = 0; k < desc.n_body; k++) {
    fb_vec3_cross(v_dot[k], at.motion[k].w, at.motion[k].v);
    for (int i = 0; i < 3; i++) {
      v_dot[k][i] = at.motion[k].acceleration[i] - v_dot[k][i];
    }
  }
  for (int s = -2; s <= 2; s++) {
    static const double weight[5] = {1.0 / 12, -2.0 / 3, 0, 2.0 / 3, -1.0 / 12};
    fb_system_input moving = input;
    for (int k = 1; k < 3; k++) {
      moving.drive[k].rate[k - 1] += (fb_real)(s * h) * moving.drive[k].acceleration[k - 1];
    }
    moved(&kept, &state, &rate, s * h);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &side, &kept, &moving), FB_OK);
    for (int k = 0; k < desc.n_body; k++) {
      for (int i = 0; i < 3; i++) {
        v_dot[k][i] -= (fb_real)(weight[s + 2] / h) * side.motion[k].v[i];
        at.motion[k].w_dot[i] -= (fb_real)(weight[s + 2] / h) * side.motion[k].w[i];
        at.joint[k].acceleration[i] -= (fb_real)(weight[s + 2] / h) * side.joint[k].speed[i];
      }
      for (int a = 0; a < model[desc.model[k]].n; a++) {
        at.motion[k].q_ddot[a] -= (fb_real)(weight[s + 2] / h) * side.motion[k].q_dot[a];
      }
    }
  }
  for (int k = 0; k < desc.n_body; k++) {
    worst = fmax(worst, fmax(fbt_largest(v_dot[k], 3), fbt_largest(at.motion[k].w_dot, 3)));
    worst = fmax(worst, fbt_largest(at.motion[k].q_ddot, model[desc.model[k]].n));
    worst = fmax(worst, fbt_largest(at.joint[k].acceleration, 3));
  }
  FBT_BELOW(worst, FBT_TOL(1e-8, 1e-2));
}

/* Motion of a couple, its joint j as number 1, backwards with the other sign, and of the whole the power, that of the
   motors, the energy; whatever the scratch held before. */
static void couple_eval(fb_system_motion *at, fb_real whole[3], int j, int backwards)
{
  fb_energy energy;
  memset(&work, 0xff, sizeof work);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, at, &state, &input), FB_OK);
  memset(&work, 0xff, sizeof work);
  FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, &input), FB_OK);
  FBT_INT_EQ(fb_system_energy_eval(&mechanism, model, &work, &energy, &state, &input), FB_OK);
  whole[0] = at->power;
  whole[1] = rate.motor_work;
  whole[2] = energy.kinetic + energy.strain;
  at->joint[1] = at->joint[j];
  for (int i = 0; i < 3 && backwards; i++) {
    fb_joint_motion *joint = &at->joint[1];
    joint->value[i] *= FB_R(-1.0);
    joint->speed[i] *= FB_R(-1.0);
    joint->drive[i] *= FB_R(-1.0);
  }
}

/* x times s, n numbers */
static void multiply(fb_real *x, int n, double s)
{
  for (int i = 0; i < n; i++) {
    x[i] *= (fb_real)s;
  }
}

/* Unit of axis i of a joint: of a length, or 1. */
static double unit_of(fb_joint_kind kind, int i)
{
  return i == axes_of((int)kind)->slide || (kind == FB_JOINT_FREE && i < 3) ? meter : 1.0;
}

/* From SI to the units: a joint, how it starts and what drives it. */
static void joint_in_units(fb_joint_desc *j, fb_link_motion *m, fb_drive *d)
{
  const double torque = kilogram * pow(meter / second, 2.0), hertz = 1.0 / second;
  multiply(j->position, 3, meter);
  multiply(j->child_position, 3, meter);
  multiply(&j->pitch, 1, meter);
  for (int i = 0; i < 6; i++) {
    const double length = unit_of(j->kind, i);
    multiply(&m->speed[i], 1, length * hertz);
    multiply(&d->rate[i], 1, length * hertz);
    multiply(&d->acceleration[i], 1, length * hertz * hertz);
    if (i < 3) {
      multiply(&m->value[i], 1, length);
      multiply(&d->value[i], 1, length);
      multiply(&d->torque[i], 1, torque / length);
      multiply(&j->rest[i], 1, length);
      multiply(&j->stiffness[i], 1, torque / (length * length));
      multiply(&j->damping[i], 1, torque * second / (length * length));
    }
  }
  multiply(m->q, FB_MAX_MODES, sqrt(kilogram) * meter);
  multiply(m->q_dot, FB_MAX_MODES, sqrt(kilogram) * meter * hertz);
}

static void system_in_units(void)
{
  fb_link_motion none;
  memset(&none, 0, sizeof none);
  for (int j = 0; j < desc.n_body + desc.n_loop; j++) {
    const int loop = j - desc.n_body;
    joint_in_units(loop < 0 ? &desc.joint[j] : &desc.loop[loop], loop < 0 ? &start[j] : &none, &input.drive[j]);
  }
  for (int i = 0; i < input.n_load; i++) {
    multiply(input.load[i].load.force, 3, kilogram * meter / (second * second));
    multiply(input.load[i].load.torque, 3, kilogram * pow(meter / second, 2.0));
  }
}

/* What motion_difference compares, back to SI. */
static void motion_in_si(fb_system_motion *all)
{
  const double force = kilogram * meter / (second * second), q = sqrt(kilogram) * meter;
  for (int k = 0; k < desc.n_body; k++) {
    fb_motion *m = &all->motion[k];
    multiply(all->pose[k].rho, 3, 1.0 / meter);
    multiply(all->pose[k].q, FB_MAX_MODES, 1.0 / q);
    multiply(m->v, 3, second / meter);
    multiply(m->w, 3, second);
    multiply(m->q_dot, FB_MAX_MODES, second / q);
    multiply(m->acceleration, 3, second * second / meter);
    multiply(m->w_dot, 3, second * second);
    multiply(m->q_ddot, FB_MAX_MODES, second * second / q);
    multiply(m->reaction_force, 3, 1.0 / force);
    multiply(m->reaction_torque, 3, 1.0 / (force * meter));
    multiply(all->joint[k].force, 3, 1.0 / force);
    multiply(all->joint[k].torque, 3, 1.0 / (force * meter));
    for (int i = 0; i < 3; i++) {
      const double length = unit_of(joint_of(k)->kind, i);
      multiply(&all->joint[k].speed[i], 1, second / length);
      multiply(&all->joint[k].drive[i], 1, length / (force * meter));
    }
  }
}

/* How the tree (in a form) or a pair of bodies (a kind of joint that closes a loop; where it has them: at) moves in
   the units that are set, in SI; and power, energy, momentum, longest step. */
static void motion_in_units(fb_system_motion *out, double whole[5], int form, int kind, const fb_system_motion *at)
{
  const double joule = kilogram * pow(meter / second, 2.0);
  fb_energy energy;
  fb_momentum momentum;
  if (at) {
    couple((fb_joint_kind)kind, 0, FB_AXIS_FREE);
    couple_by_a_loop(at, 0);
  } else {
    tree(FB_EFFECTS_FULL, 1);
    drives();
  }
  system_in_units();
  init(form);
  memset(&work, 0xff, sizeof work); /* what is in it means nothing */
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  if (!at) {
    stepped(&state, 3, FBT_TOL(2e-4, 2e-3) * second);
  }
  motion_of(out, &state);
  FBT_INT_EQ(fb_system_energy_eval(&mechanism, model, &work, &energy, &state, &input), FB_OK);
  FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &momentum, &state, &input), FB_OK);
  whole[0] = (double)out->power * second / joule;
  whole[1] = (double)energy.kinetic / joule;
  whole[2] = (double)energy.strain / joule;
  whole[3] = (double)fbt_largest(momentum.angular, 3) / (joule * second);
  whole[4] = 1e3 * (double)fb_system_rk4_limit(&mechanism, model, 0, 0) / second;
  motion_in_si(out);
}

/* E9.1 to E9.19: a tree of all joints in each form, and pairs of bodies that a loop holds together, measured in other
   units of mass, length and time: the same motion, power, energy, momentum and longest step. */
TEST(systems_know_no_units)
{
  static const int exponent[3][3] = {{0, 0, 0}, {26, 6, 8}, {-26, -6, -8}}; /* of two */
  static fb_system_motion apart, first;
  for (int run = 0; run < 9; run++) {
    const int form = run < 3 ? run : (int)FB_METHOD_RECURSIVE, kind = run < 3 ? 0 : (int)FB_JOINT_RIGID + run - 3;
    double si[5], whole[5];
    if (run >= 3) {
      couple((fb_joint_kind)kind, 0, FB_AXIS_FREE);
      init(FB_METHOD_RECURSIVE);
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
      FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &apart, &state, NULL), FB_OK);
    }
    for (int u = 0; u < 3; u++) {
      kilogram = ldexp(1.0, exponent[u][0] / (FB_SINGLE ? 2 : 1));
      meter = ldexp(1.0, exponent[u][1] / (FB_SINGLE ? 2 : 1));
      second = ldexp(1.0, exponent[u][2] / (FB_SINGLE ? 2 : 1));
      motion_in_units(u ? &motion : &first, u ? whole : si, form, kind, run < 3 ? NULL : &apart);
      FBT_BELOW(u ? motion_difference(&motion, &first) : 0.0, FBT_TOL(1e-9, 1e-3));
      for (int i = 0; i < 5 && u; i++) {
        FBT_NEAR_REL(whole[i], si[i], FBT_TOL(1e-9, 1e-3));
      }
    }
    kilogram = meter = second = 1.0;
  }
}

/* E9.7 to E9.15, E9.19: every kind of joint, free or with an axis locked or prescribed, moves two bodies in the same
   way from joint coordinates, by the dense matrix and as a loop of free bodies, forwards and backwards:
   at the start, after a while, and after an axis is locked in motion. */
TEST(every_joint_is_the_same_eliminated_or_closing_a_loop)
{
  static fb_system_motion first[3];
  for (int kind = (int)FB_JOINT_RIGID; kind < (int)FB_JOINT_COUNT; kind++) {
    const int ball = kind == FB_JOINT_SPHERICAL;
    const int axes = ball ? 1 : axes_of(kind)->count;           /* all of a ball have one mode */
    const int forms = ball || axes_of(kind)->tilt >= 0 ? 3 : 4; /* their axes have an order */
    for (int given = 0; given <= 2 * axes; given++) {           /* each locked, prescribed */
      const fb_axis_mode mode = given == 0 ? FB_AXIS_FREE : given % 2 ? FB_AXIS_LOCKED : FB_AXIS_PRESCRIBED;
      fb_real whole[3][3], other[3];
      for (int form = 0; form < forms; form++) {
        const int joint = form < 2 ? 1 : 2;
        couple((fb_joint_kind)kind, given > 0 ? (given - 1) / 2 : 0, mode);
        if (form >= 2) {
          couple_by_a_loop(&first[0], form == 3);
        }
        init(form < 2 ? form : (int)FB_METHOD_RECURSIVE);
        FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
        for (int instant = 0; instant < 3; instant++) {
          fb_system_motion *tree_motion = &first[instant];
          couple_steps(instant > 0 ? 10 : 0, FBT_TOL(2e-4, 1e-3));
          if (instant == 2 && axes > 0) {
            memset(&work, 0xff, sizeof work);
            FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &state, &work, joint, axes - 1, FB_AXIS_LOCKED, &input),
                       FB_OK);
            couple_steps(5, FBT_TOL(2e-4, 1e-3));
          }
          if (form == 0) {
            couple_eval(tree_motion, whole[instant], joint, 0);
            continue;
          }
          couple_eval(&motion, other, joint, form == 3);
          if (form == 3) { /* they are about the other frame */
            memcpy(motion.joint[1].force, tree_motion->joint[1].force, sizeof motion.joint[1].force);
            memcpy(motion.joint[1].torque, tree_motion->joint[1].torque, sizeof motion.joint[1].torque);
          }
          FBT_BELOW(motion_difference(&motion, tree_motion), instant ? FBT_TOL(1e-9, 1e-2) : FBT_TOL(1e-11, 1e-3));
          FBT_BELOW(fbt_difference(motion.joint[1].value, tree_motion->joint[1].value, 3), FBT_TOL(1e-10, 1e-3));
          FBT_BELOW(fbt_difference(other, whole[instant], 3), instant ? FBT_TOL(1e-9, 1e-2) : FBT_TOL(1e-11, 1e-3));
        }
      }
    }
  }
}

typedef struct crowd {
  int rows, ends, beyond; /* rows (0: as many as there is room for), nodes that they hold, how many more to claim */
} crowd;

/* Ties nodes of the last bodies, of high numbers, to each other, each time in another way, in directions that turn with
   a body. */
static int crowd_rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  crowd *const tied = (crowd *)user;
  (void)t;
  tied->rows = tied->rows ? tied->rows : capacity;
  for (int k = 0; k < tied->rows && k < capacity; k++) {
    for (int s = 0; s < 2; s++) {
      const int end = (k * (s + 1) + s) % tied->ends;
      fb_real force[3], torque[3];
      row[k].body[s] = FB_MAX_BODIES - 1 - end % FB_MAX_BODIES;
      row[k].node[s] = FB_MAX_NODES - 1 - end / FB_MAX_BODIES;
      for (int i = 0; i < 3; i++) {
        force[i] = (fb_real)sin(1.0 + 7.0 * k * k + 5.0 * s + i);
        torque[i] = (fb_real)sin(2.0 + 3.0 * k * k + 4.0 * s + i);
      }
      fb_mat33_mul_vec3(row[k].force[s], pose[k % FB_MAX_BODIES].R, force);
      fb_mat33_mul_vec3(row[k].torque[s], pose[k % FB_MAX_BODIES].R, torque);
    }
  }
  return tied->rows + tied->beyond;
}

/* As many bodies as there can be, each with as many modes and nodes, by all kinds of joints; motors, springs, an axis
   that is locked; as many loads; as many loops, to the ground, nearly closed. */
static void full_house(void)
{
  fresh();
  fbt_seed(17);
  body_desc.effects = FB_EFFECT_GRAVITY;
  fbt_fill(body_desc.gravity, 3, 3.0);
  crowded(&model[0]);
  for (int k = 0; k < FB_MAX_BODIES; k++) {
    fb_joint_desc *j = &desc.joint[k];
    hang(k, 0, (fb_joint_kind)(k % 8), k < 2 ? k - 1 : k - 2, 1 + k % (FB_MAX_NODES - 5));
    fbt_fill(start[k].value, 3, 0.5);
    fbt_fill(start[k].speed, 6, 0.5);
    fbt_fill(start[k].q, FB_MAX_MODES, 0.05);
    fbt_fill(start[k].q_dot, FB_MAX_MODES, 0.2);
    fbt_fill(j->position, 3, 0.2);
    fbt_fill(j->child_position, 3, 0.2);
    j->pitch = FB_R(0.1);
    for (int i = 0; i < 3 && k % 8 > 0; i++) {
      j->stiffness[i] = (fb_real)(2.0 + fbt_random());
    }
    fbt_fill(input.drive[k].torque, 3, 0.5);
    for (int i = 0; i < 3; i++) {
      input.drive[k].torque[i] = motor_of(k, i, (double)input.drive[k].torque[i]);
    }
    input.load[k % FB_MAX_LOADS].body = k;
  }
  desc.joint[4].mode[1] = FB_AXIS_LOCKED;
  start[4].speed[1] = FB_R(0.0);
  input.n_load = FB_MAX_LOADS;
  for (int i = 0; i < FB_MAX_LOADS; i++) {
    input.load[i].load.node = FB_MAX_NODES - 1 - i % FB_MAX_NODES;
    input.load[i].load.axes = (fb_axes)(i % 3);
    fbt_fill(input.load[i].load.force, 3, 1.0);
    fbt_fill(input.load[i].load.torque, 3, 0.3);
  }
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
  for (int j = 0; j < FB_MAX_LOOPS; j++) {
    double x[3];
    fb_joint_desc *loop = close_loop(FB_JOINT_SPHERICAL, FB_GROUND, 0, FB_MAX_BODIES - 1 - j, FB_MAX_NODES - 4);
    node_at(x, &state, FB_MAX_BODIES - 1 - j, FB_MAX_NODES - 4);
    for (int i = 0; i < 3; i++) {
      loop->position[i] = (fb_real)x[i];
    }
  }
}

/* Power of motors, of what is prescribed, and of the loads. */
static double power_of(const fb_system_motion *at)
{
  double power = (double)at->power;
  for (int i = 0; i < input.n_load; i++) {
    const fb_load *load = &input.load[i].load;
    const int k = input.load[i].body;
    fb_real R[9], v[3], w[3];
    fb_node_motion node;
    FBT_INT_EQ(fb_body_node_motion_eval(&model[desc.model[k]], &node, &at->pose[k], &at->motion[k], load->node), FB_OK);
    memcpy(v, node.velocity, sizeof v);
    memcpy(w, node.angular_rate, sizeof w);
    if (load->axes != FB_AXES_INERTIAL) {
      fb_quat_to_mat33(R, load->axes == FB_AXES_BODY ? at->pose[k].quat : node.quat);
      fb_mat33_mulT_vec3(v, R, node.velocity);
      fb_mat33_mulT_vec3(w, R, node.angular_rate);
    }
    power += (double)(fb_vec3_dot(load->force, v) + fb_vec3_dot(load->torque, w));
  }
  return power;
}

/* Rate of the energy along the rates of the state. */
static double energy_rate(void)
{
  static const double weight[5] = {1.0 / 12, -2.0 / 3, 0, 2.0 / 3, -1.0 / 12};
  const double h = FBT_TOL(1e-4, 1e-2);
  double slope = 0.0;
  FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, &input), FB_OK);
  for (int side = -2; side <= 2; side++) {
    moved(&kept, &state, &rate, side * h);
    slope += weight[side + 2] / h * energy_of(&kept);
  }
  return slope;
}

/* From the state on: a step by either integrator does the work of the mean power; both end alike; it may be looked at,
   an axis freed and locked again. */
static void full_step(double dt)
{
  static fb_system_motion first;
  static fb_system_state begin;
  const double before = energy_of(&state);
  const fb_real h = (fb_real)dt;
  begin = state;
  for (int integrator = 0; integrator < 2; integrator++) {
    double power;
    state = begin;
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
    power = power_of(&motion);
    FBT_INT_EQ(integrator ? fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, h, 0)
                          : fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, h),
               FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, integrator ? &motion : &first, &state, &input), FB_OK);
    power = 0.5 * (power + power_of(integrator ? &motion : &first));
    FBT_NEAR_REL(energy_of(&state) - before, power * dt, FBT_TOL(1e-3, 1e-1));
  }
  FBT_BELOW(motion_difference(&motion, &first), FBT_TOL(1e-7, 1e-4));
  FBT_INT_EQ(fb_system_state_check(&mechanism, model, &state), FB_OK);
  FBT_TRUE(fb_system_crc(&mechanism, model, FB_MAX_BODIES) != 0);
  FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &state, &work, 4, 1, FB_AXIS_FREE, &input), FB_OK);
  FBT_INT_EQ(fb_system_axis_set(&mechanism, model, &state, &work, 4, 1, FB_AXIS_LOCKED, &input), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &first, &state, &input), FB_OK);
  FBT_BELOW(motion_difference(&motion, &first), FBT_TOL(1e-10, 1e-2));
}

/* E9.3 to E9.19: there may be as many bodies, modes, nodes, loops, loads, constraints and nodes in them as the header
   says, and not one more: the energy changes by the power of motors and loads. */
TEST(a_full_system_balances_its_energy)
{
  crowd tied = {0, 0, 0};
  full_house();
  input.rows = crowd_rows;
  input.user = &tied;
  tied.ends = 2 * (FB_MAX_BODIES + FB_MAX_LOOPS) - 1 - FB_MAX_LOOPS; /* loops hold nodes of bodies and the ground */
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  FBT_TRUE(work.n_row == FB_MAX_ROWS && work.n_end == 2 * (FB_MAX_BODIES + FB_MAX_LOOPS));
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
  FBT_NEAR_ABS(energy_rate(), power_of(&motion), FBT_TOL(1e-9, 2e-2));
  full_step(FBT_TOL(1e-3, 4e-3));        /* single: longer, as its work is a few last digits of the energy */
  for (int more = 0; more < 2; more++) { /* a row, a node that rows hold */
    crowd over = tied;
    over.beyond = 1 - more;
    over.ends += more;
    input.user = &over;
    kept = state;
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(1e-3)),
               FB_ERR_CAPACITY);
    FBT_TRUE(memcmp(&kept, &state, sizeof state) == 0);
  }
}

/* E9.6: the dense matrix takes as many speeds as there is room for, and not one more. */
TEST(a_dense_matrix_may_be_full)
{
  static fb_system_motion first;
  int speeds = 6 + 2 + 2 * FB_MAX_MODES, n = 2;
  fresh();
  fbt_seed(19);
  crowded(&model[0]);
  rigid(&model[1], 0.7, 0.2, 0.1, -0.1, 0.3, 0.5, 0.4);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  hang(1, 0, FB_JOINT_UNIVERSAL, 0, 1);
  for (; speeds < FB_MAX_SPEEDS; n++) {
    const int left = FB_MAX_SPEEDS - speeds;
    hang(n, 1, left > 2 ? FB_JOINT_SPHERICAL : left > 1 ? FB_JOINT_UNIVERSAL : FB_JOINT_REVOLUTE, n % 2, 1 + n);
    speeds += left > 2 ? 3 : left;
  }
  for (int k = 0; k < n; k++) {
    fbt_fill(start[k].value, 3, 0.3);
    fbt_fill(start[k].speed, 6, 0.5);
    fbt_fill(start[k].q, FB_MAX_MODES, 0.05);
    fbt_fill(start[k].q_dot, FB_MAX_MODES, 0.2);
  }
  for (int method = 0; method < 2; method++) {
    init(method);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
    FBT_INT_EQ(fb_system_sdirk_step(&mechanism, model, &state, &work, NULL, NULL, FB_R(1e-2), 0), FB_OK);
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, method ? &motion : &first, &state, NULL), FB_OK);
  }
  FBT_BELOW(motion_difference(&motion, &first), FBT_TOL(1e-10, 1e-2));
  hang(n, 1, FB_JOINT_REVOLUTE, 0, 1);
  FBT_INT_EQ(fb_system_init(&mechanism, &work, model, &desc, 2), FB_ERR_CAPACITY);
}

/* E9.16: speeds in, momenta out, the same speeds again; freed axes too. */
TEST(momenta_give_back_the_speeds)
{
  tree(FB_EFFECTS_FULL, 0);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), FB_OK);
  for (int k = 0; k < desc.n_body; k++) {
    const int axes = mechanism.joint[k].n_axis;
    FBT_BELOW(fbt_difference(motion.joint[k].speed, start[k].speed, axes), FBT_TOL(1e-12, 1e-4));
    FBT_BELOW(fbt_difference(motion.motion[k].q_dot, start[k].q_dot, model[desc.model[k]].n), FBT_TOL(1e-12, 1e-3));
  }
}

/* Lowest frequencies [rad/s] of a system at rest: the mass matrix from the momenta of unit speeds, K of the modes. */
static void system_frequencies(double *omega, int count)
{
  static fb_real M[FB_MAX_SPEEDS * FB_MAX_SPEEDS], K[FB_MAX_SPEEDS * FB_MAX_SPEEDS], X[FB_MAX_SPEEDS * FB_MAX_SPEEDS];
  static fb_real d[FB_MAX_SPEEDS];
  int N = 0;
  for (int k = 0; k < desc.n_body; k++) {
    N += model[desc.model[k]].n;
  }
  memset(K, 0, sizeof K);
  for (int k = 0, c = 0; k < desc.n_body; k++) {
    for (int a = 0; a < model[desc.model[k]].n; a++, c++) {
      memset(start, 0, sizeof start);
      start[k].q_dot[a] = FB_R(1.0);
      for (int b = 0; b < modes.n; b++) {
        K[c * N + c - a + b] = modes.K[a * modes.n + b];
      }
      FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
      for (int j = 0, r = 0; j < desc.n_body; j++) {
        for (int b = 0; b < model[desc.model[j]].n; b++, r++) {
          M[r * N + c] = state.link[j].pi[b];
        }
      }
    }
  }
  FBT_INT_EQ(fb_eig_gen_solve(d, X, K, M, N), FB_OK);
  for (int i = 0; i < count; i++) {
    omega[i] = sqrt((double)d[i]);
  }
  memset(start, 0, sizeof start);
}

/* A cantilever of length 1 cut into `parts`, two constraint modes and `bending` modes each. */
static void cut_beam(int parts, int bending)
{
  fresh();
  memset(&beam_desc, 0, sizeof beam_desc);
  body_desc.effects = FB_EFFECTS_SPIN;
  {
    static fb_modes_desc keep;
    int node;
    memset(&keep, 0, sizeof keep);
    beam_desc.length = (fb_real)(1.0 / parts);
    beam_desc.n_element = 6;
    beam_desc.n_station = 1;
    beam_desc.station[0].mass = FB_R(1.0);
    beam_desc.station[0].EI_z = FB_R(1.0);
    keep.basis = FB_BASIS_COMPONENT; /* what the next part does to the tip bends it exactly */
    keep.n_boundary = 2;
    keep.boundary[0].node = keep.boundary[1].node = 6;
    keep.boundary[0].axis = 1;
    keep.boundary[1].axis = 5;
    keep.count[FB_KIND_BEND_Y] = bending;
    body_desc.base = FB_BASE_PRESCRIBED;
    FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
    FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, (fb_real)(1.0 / parts)), FB_OK);
    FBT_INT_EQ(fb_body_init(&model[0], &body_work, &shape, &body_desc), FB_OK);
  }
  for (int k = 0; k < parts; k++) {
    hang(k, 0, FB_JOINT_RIGID, k - 1, k > 0);
  }
  init(FB_METHOD_RECURSIVE);
}

/* Largest difference of the tip's motion from that of the clamped beam's exact modes, after a small force on the tip is
   let go: y = sum of a_k cos(omega_k t), over the static deflection. */
static double cut_transient(int parts)
{
  static const double beta[] = {1.8751040687119611, 4.6940911329741746, 7.8547574382376126, 10.995540734875467,
                                14.13716839104647};
  const double dt = 2e-4, F = 1e-3;
  double worst = 0.0;
  fb_system_input pull;
  memset(&pull, 0, sizeof pull);
  pull.n_load = 1;
  pull.load[0].body = parts - 1;
  pull.load[0].load.node = 1;
  pull.load[0].load.force[1] = (fb_real)F;
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, NULL, NULL), FB_OK);
  for (int step = 1; step <= 4000; step++) { /* the force comes on at t = 0: y = sum a_k (1 - cos) */
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &pull, &pull, &pull, (fb_real)dt), FB_OK);
    if (step % 20 == 0) {
      double x[3], y = 0.0;
      for (int k = 0; k < 5; k++) {
        const double w = beta[k] * beta[k];
        y += F * 4.0 / (w * w) * (1.0 - cos(w * dt * step)); /* psi(1) = 2 of the normalized mode */
      }
      node_at(x, &state, parts - 1, 1);
      worst = fmax(worst, fabs(x[1] - y) / (F / 3.0));
    }
  }
  return worst;
}

/* E9.12: one beam cut into two, three and four bodies joined rigidly is the uncut one within the truncation error,
   which falls as modes are added: frequencies and the response to a force. */
TEST(a_cut_beam_behaves_as_the_whole)
{
  static const double exact[] = {3.5160152685, 22.034491530, 61.697214402};
  for (int parts = 2; parts <= 4; parts++) {
    double before[3] = {1, 1, 1}, transient = 1.0;
    for (int bending = 0; bending <= 2; bending++) {
      double omega[3], response;
      cut_beam(parts, bending);
      system_frequencies(omega, 3);
      response = cut_transient(parts);
      for (int k = 0; k < 3; k++) {
        const double error = omega[k] / exact[k] - 1.0;
        FBT_TRUE(error > -FBT_TOL(1e-6, 1e-3)); /* Ritz: from above */
        FBT_BELOW(error, before[k]);
        before[k] = fmax(error, FBT_TOL(1e-6, 1e-3));
      }
      FBT_BELOW(response, transient);
      transient = FB_SINGLE ? 1.0 : response;
      if (bending == 2 && parts == 4) {
        fbt_figure("cantilever cut into four bodies, third frequency", "closed form", fabs(omega[2] / exact[2] - 1.0));
        fbt_figure("the same, response to a force on the tip [static deflections]", "closed form", response);
      }
    }
  }
}

/* E9.13, E9.15, E11.12: a chain of six flexible bodies in free flight, driven by its motors: total momenta stay, energy
   changes by the motors' work. The same over 1e6 steps is make check-long. */
TEST(a_chain_in_free_flight_keeps_its_momenta)
{
  fb_momentum before, after;
  double energy;
  const int steps = 2000;
  fresh();
  flexible(&model[0], 2, 1, 1, FB_EFFECTS_FULL);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND, 0);
  for (int k = 1; k < 6; k++) {
    hang(k, 0, k % 2 ? FB_JOINT_REVOLUTE : FB_JOINT_UNIVERSAL, k - 1, 1);
    desc.joint[k].stiffness[0] = desc.joint[k].stiffness[1] = FB_R(2.0);
    start[k].value[0] = FB_R(0.3);
    start[k].speed[0] = FB_R(0.1);
  }
  start[0].speed[4] = FB_R(0.2);
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
  FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &before, &state, &input), FB_OK);
  energy = energy_of(&state);
  for (int step = 0; step < steps; step++) {
    for (int k = 1; k < 6; k++) {
      input.drive[k].torque[0] = (fb_real)(0.02 * sin(0.004 * step * k));
    }
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(5e-4)), FB_OK);
  }
  FBT_INT_EQ(fb_system_momentum_eval(&mechanism, model, &work, &after, &state, &input), FB_OK);
  FBT_BELOW(fbt_difference(after.linear, before.linear, 3), FBT_TOL(1e-12, 1e-4));
  FBT_BELOW(fbt_difference(after.angular, before.angular, 3), FBT_TOL(1e-12, 1e-3));
  FBT_NEAR_ABS(energy_of(&state) - energy, state.motor_work, FBT_TOL(1e-8, 1e-3));
}

/* E9.4: whether an axis moves inertia is a matter of proportion: two hinges of micrograms and micrometers, swing as
   k (1/J_0 + 1/J_1) has it. */
TEST(specks_swing_as_large_bodies_do)
{
  const double J0 = 0.2, J1 = 0.3, k = 5.0;
  kilogram = 1e-9;
  meter = 1e-6;
  fresh();
  rigid(&model[0], 1.0, 0, 0, 0, 1, 1, J0);
  rigid(&model[1], 2.0, 0, 0, 0, 1, 1, J1);
  for (int j = 0; j < 2; j++) {
    hang(j, j, FB_JOINT_REVOLUTE, j - 1, 0);
  }
  desc.joint[1].stiffness[0] = (fb_real)(k * kilogram * meter * meter);
  init(FB_METHOD_RECURSIVE);
  FBT_NEAR_REL(fb_system_rk4_limit(&mechanism, model, 0, 0), 2.785 / sqrt(1.05 * k * (1.0 / J0 + 1.0 / J1)),
               FBT_TOL(1e-9, 1e-4));
  kilogram = meter = 1.0;
}

/* E9.4: a load of ten thousand links on a chain of eight, each turned by 0.1, begins to fall as its equations have it:
   what a hinge moves is its link alone, a millionth of what hangs on it and no rounding. */
TEST(heavy_loads_hang_on_light_chains)
{
  const int n = 8;
  const double load = 1e4;
  double x[16] = {0}, dx[16];
  fresh();
  body_desc.effects = FB_EFFECT_GRAVITY;
  body_desc.gravity[1] = -FB_R(9.81);
  rigid(&model[0], 1.0, 0, -0.5, 0, 1.0 / 12.0, 0, 1.0 / 12.0);
  rigid(&model[1], load, 0, -0.5, 0, load / 12.0, 0, load / 12.0);
  for (int k = 0; k < n; k++) {
    hang(k, k == n - 1, FB_JOINT_REVOLUTE, k - 1, k > 0);
    start[k].value[0] = FB_R(0.1);
    x[k] = 0.1 * (k + 1);
  }
  init(FB_METHOD_RECURSIVE);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, NULL), FB_OK);
  FBT_INT_EQ(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, NULL), FB_OK);
  pendulum_rates(dx, x, n, load);
  for (int k = 0; k < n; k++) {
    const double exact = dx[n + k] - (k > 0 ? dx[n + k - 1] : 0.0);
    FBT_NEAR_ABS(motion.joint[k].acceleration[0], exact, FBT_TOL(1e-7, 0.1)); /* of up to 30 rad/s^2 */
  }
}

SUITE(system_trees, RUN(accelerations_are_the_rates_of_velocities), RUN(systems_keep_energy_and_momentum),
      RUN(momenta_give_back_the_speeds), RUN(methods_agree_on_as_many_modes_as_there_can_be),
      RUN(heavy_loads_hang_on_light_chains), RUN(a_dense_matrix_may_be_full), RUN(specks_swing_as_large_bodies_do),
      RUN(a_chain_in_free_flight_keeps_its_momenta), RUN(systems_know_no_units), RUN_LONG(flight_speed_changes_nothing),
      RUN(driven_roots_fly_as_they_stand), RUN(fast_systems_keep_their_angular_momentum),
      RUN(every_set_keeps_the_momenta_of_free_systems), RUN(a_full_system_balances_its_energy),
      RUN(every_joint_is_the_same_eliminated_or_closing_a_loop), RUN(the_three_methods_agree),
      RUN_LONG(a_cut_beam_behaves_as_the_whole))
