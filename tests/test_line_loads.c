/* >>line and >>body: distributed loads on lines, internal loads by points, strain gauges, damping. */
#include "fbt.h"

#include <math.h>
#include <string.h>

static fb_body body;
static fb_body_work body_work;
static fb_shape shape;
static fb_beam_desc line;
static fb_beam beam;
static fb_modes_desc keep;
static fb_modes modes;
static fb_modes_work modes_work;
static fb_body_desc level;
static fb_line_motion point[FB_MAX_LINE_POINTS];
static int n_point;

/* A uniform line of 2 m, 0.9 kg/m; heavy: offset mass, rotary inertia, torsion and a tip body. */
static void line_make(int heavy)
{
  memset(&line, 0, sizeof line);
  memset(&keep, 0, sizeof keep);
  memset(&level, 0, sizeof level);
  line.length = FB_R(2.0);
  line.n_element = heavy ? 2 : 1; /* modes are one polynomial between the points' ends: quadrature is exact */
  line.n_station = 1;
  line.station[0].mass = FB_R(0.9);
  line.station[0].EI_y = FB_R(20.0);
  line.station[0].EI_z = FB_R(30.0);
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 3;
  keep.line_points = heavy ? 26 : 16;
  if (heavy) {
    line.station[0].GJ = FB_R(15.0);
    line.station[0].i_y = FB_R(0.002);
    line.station[0].i_z = FB_R(0.004);
    line.station[0].mass_y = FB_R(0.01);
    line.station[0].mass_z = FB_R(-0.02);
    line.n_lump = 2;
    line.lump[0].node = 2;
    line.lump[0].mass = FB_R(0.4);
    line.lump[0].center[1] = FB_R(0.05);
    line.lump[0].inertia[0] = line.lump[0].inertia[1] = line.lump[0].inertia[2] = FB_R(0.01);
    line.lump[1].node = 1;
    line.lump[1].mass = FB_R(0.2);
    line.lump[1].center[2] = FB_R(0.03);
    keep.count[FB_KIND_TORSION] = 1;
  }
  level.effects = FB_EFFECTS_LARGE;
  level.base = FB_BASE_PRESCRIBED;
}

/* The body of that line, hub of mass `hub` at O, nodes 1 at the tip and 2 at 0.7 m. */
static void line_body(double hub)
{
  const fb_real none[3] = {0, 0, 0}, inertia[6] = {FB_R(3.0), FB_R(2.0), FB_R(2.5), 0, 0, 0};
  int node;
  FBT_INT_EQ(fb_beam_init(&beam, &line), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  if (hub > 0.0) {
    FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)hub, none, inertia), FB_OK);
  }
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, line.length), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, FB_R(0.7)), FB_OK);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
  body.allow_long_step = 1;
}

/* Bent by up to a radian, moving, at an attitude of no axis. */
static void state_make(fb_state *state, double size)
{
  FBT_INT_EQ(fb_state_init(&body, state), FB_OK);
  for (int a = 0; a < body.n; a++) {
    state->q[a] = (fb_real)(size * 0.5 * sin(1.3 * a + 1.0) / (1 + a / 2));
    state->pi[a] = (fb_real)(size * cos(2.1 * a));
  }
  state->quat[0] = FB_R(0.8);
  state->quat[1] = FB_R(0.48);
  state->quat[3] = FB_R(0.36);
  for (int i = 0; i < 3 && body.base == FB_BASE_FREE; i++) {
    state->rho[i] = (fb_real)(0.3 - 0.2 * i);
    state->u[i] = (fb_real)(0.5 * i - 0.3);
    state->L[i] = (fb_real)(2.0 - 1.5 * i);
  }
}

/* What a callback is told. */
typedef struct told {
  double g[3], drag, spring; /* [m/s^2], [1/s], [1/s^2] per mass */
  double hub;                /* [kg] at the first point, with the inertia of line_body */
  int calls, fails;          /* fails: the call of this number does; negative: it writes no number */
} told;

/* Per mass g - drag v - spring r; at the first point that of the hub, too, with -drag times its angular momentum. */
static fb_status field(fb_line_point *p, int n, fb_real t, void *user)
{
  told *const own = (told *)user;
  const double J[3] = {3.0, 2.0, 2.5};
  own->calls++;
  for (int k = 0; k < n; k++) {
    const double mass = 0.9 * (double)p[k].length + (k == 0 ? own->hub : 0.0);
    for (int i = 0; i < 3; i++) {
      p[k].force[i] =
          (fb_real)(mass * (own->g[i] - own->drag * (double)p[k].velocity[i] - own->spring * (double)p[k].position[i]));
    }
    for (int i = 0; i < 3 && k == 0 && own->hub > 0.0; i++) { /* sections of a line along x: R is the body's */
      double spin = 0.0;
      for (int j = 0; j < 3; j++) {
        spin += (double)p[k].R[3 * j + i] * (double)p[k].angular_rate[j];
      }
      for (int j = 0; j < 3; j++) {
        p[k].torque[j] -= (fb_real)(own->drag * J[i] * spin * (double)p[k].R[3 * j + i]);
      }
    }
  }
  if (own->fails && own->calls == abs(own->fails)) {
    p[n - 1].torque[1] = own->fails < 0 ? (fb_real)NAN : FB_R(0.0);
    return own->fails < 0 ? FB_OK : FB_ERR_CONVERGENCE;
  }
  (void)t;
  return FB_OK;
}

static fb_input by_callback(told *user)
{
  fb_input input;
  memset(&input, 0, sizeof input);
  input.distributed = field;
  input.user = user;
  return input;
}

static void same_motion(const fb_motion *a, const fb_motion *b, double tol)
{
  for (int i = 0; i < 3; i++) {
    FBT_NEAR_ABS(a->acceleration[i], b->acceleration[i], tol);
    FBT_NEAR_ABS(a->w_dot[i], b->w_dot[i], tol);
    FBT_NEAR_ABS(a->reaction_force[i], b->reaction_force[i], tol);
    FBT_NEAR_ABS(a->reaction_torque[i], b->reaction_torque[i], tol);
  }
  for (int k = 0; k < body.n; k++) {
    FBT_NEAR_ABS(a->q_ddot[k], b->q_ddot[k], 10.0 * tol);
  }
}

/* E14.40: the weight of each length of the line, by a callback, is gravity: modal forces, reactions of a held base,
   motion of a free one; a line along x, turned and moved, and one with section axes that twist. */
TEST(a_weight_by_callback_is_gravity)
{
  const fb_base base[3] = {FB_BASE_PRESCRIBED, FB_BASE_FREE, FB_BASE_PINNED};
  for (int k = 0; k < 9; k++) {
    fb_state state;
    fb_input input;
    fb_motion by_gravity, by_load;
    fb_energy energy;
    told user;
    const double hub = base[k % 3] == FB_BASE_PRESCRIBED ? 0.0 : 1.5;
    memset(&user, 0, sizeof user);
    user.g[0] = 1.0;
    user.g[1] = -4.0;
    user.g[2] = 2.0;
    line_make(0);
    if (k / 3 == 1) {
      line.attitude[0] = FB_R(0.6);
      line.attitude[1] = FB_R(0.64);
      line.attitude[3] = FB_R(0.48);
      line.position[1] = FB_R(0.4);
    }
    line.station[0].twist = k / 3 == 2 ? FB_R(0.7) : FB_R(0.0);
    level.base = base[k % 3];
    level.effects = FB_EFFECTS_LARGE | FB_EFFECT_GRAVITY;
    for (int i = 0; i < 3; i++) {
      level.gravity[i] = (fb_real)user.g[i];
    }
    line_body(hub);
    state_make(&state, 1.0);
    input = by_callback(&user);
    if (hub > 0.0) {
      input.n_load = 1;
      for (int i = 0; i < 3; i++) {
        input.load[0].force[i] = (fb_real)(hub * user.g[i]);
      }
    }
    FBT_INT_EQ(fb_body_motion_eval(&body, &by_gravity, &state, NULL), FB_OK);
    FBT_INT_EQ(fb_body_energy_eval(&body, &energy, &state, NULL), FB_OK);
    memset(level.gravity, 0, sizeof level.gravity);
    line_body(hub);
    FBT_INT_EQ(fb_body_motion_eval(&body, &by_load, &state, &input), FB_OK);
    FBT_INT_EQ(user.calls, 1);
    same_motion(&by_gravity, &by_load, FBT_TOL(2e-11, 2e-2));
  }
}

/* E14.40 on offset mass centers: forces act at the line. Force f and torque of every point do the work F.v + T.w: dE/dt
   of the body, E its energy along a run; the points' velocities are the derivatives of their positions. */
static fb_status anything(fb_line_point *p, int n, fb_real t, void *user)
{
  for (int k = 0; k < n; k++) {
    for (int i = 0; i < 3; i++) {
      p[k].force[i] = p[k].length * (fb_real)sin(1.0 + 2.0 * i + 3.0 * (double)p[k].x + (double)t);
      p[k].torque[i] = FB_R(0.3) * p[k].length * (fb_real)cos(2.0 - i + (double)p[k].x);
    }
  }
  (void)user;
  return FB_OK;
}

static double energy_of(const fb_state *state)
{
  fb_energy energy;
  FBT_INT_EQ(fb_body_energy_eval(&body, &energy, state, NULL), FB_OK);
  return (double)energy.kinetic + (double)energy.strain + (double)energy.gravity;
}

static double power_of(const fb_state *state, const fb_input *input)
{
  fb_motion motion;
  double power = 0.0;
  FBT_INT_EQ(fb_body_motion_eval(&body, &motion, state, input), FB_OK);
  FBT_INT_EQ(fb_body_lines_eval(&body, point, &n_point, state, &motion, input), FB_OK);
  for (int k = 0; k < n_point; k++) {
    power += (double)fb_vec3_dot(point[k].at.force, point[k].at.velocity) +
             (double)fb_vec3_dot(point[k].at.torque, point[k].at.angular_rate);
  }
  return power;
}

/* E14.40: the work of forces and torques that depend on time and motion is the change of the energy. */
TEST(power_of_distributed_loads_is_the_rate_of_energy)
{
  for (int k = 0; k < 4; k++) {
    static fb_rk4_work work;
    const int steps = 400;
    const double dt = 1e-4;
    fb_state state;
    fb_input at[3];
    double energy, done = 0.0;
    line_make(k % 2);
    level.base = k < 2 ? FB_BASE_FREE : FB_BASE_PINNED;
    line.position[1] = FB_R(0.2);
    line_body(1.5);
    state_make(&state, 1.0);
    memset(at, 0, sizeof at);
    for (int i = 0; i < 3; i++) {
      at[i].distributed = anything;
    }
    energy = energy_of(&state);
    for (int i = 0; i < steps; i++) { /* work by Simpson's rule over pairs of steps */
      const double weight = i == 0 ? 1.0 : i % 2 ? 4.0 : 2.0;
      at[0].t = (fb_real)(i * dt);
      at[1].t = (fb_real)((i + 0.5) * dt);
      at[2].t = (fb_real)((i + 1) * dt);
      done += weight * dt / 3.0 * power_of(&state, &at[0]);
      FBT_INT_EQ(fb_rk4_step(&body, &state, &work, &at[0], &at[1], &at[2], (fb_real)dt), FB_OK);
    }
    done += dt / 3.0 * power_of(&state, &at[2]);
    FBT_TRUE(fabs(done) > 1e-2);
    FBT_NEAR_ABS(energy_of(&state) - energy, done, FBT_TOL(1e-8, 1e-3));
  }
}

/* E14.40: a drag of -drag v per mass slows every momentum of a free body alike, P and L about the origin as
   exp(-drag t), however it bends. */
TEST(drag_by_mass_slows_momenta_in_closed_form)
{
  static fb_rk4_work work;
  const double drag = 0.8, dt = 1e-3;
  fb_state state;
  fb_input input;
  fb_momentum first, last;
  told user;
  memset(&user, 0, sizeof user);
  user.drag = drag;
  user.hub = 1.5;
  line_make(0);
  level.base = FB_BASE_FREE;
  line_body(1.5);
  state_make(&state, 1.0);
  input = by_callback(&user);
  FBT_INT_EQ(fb_body_momentum_eval(&body, &first, &state, NULL), FB_OK);
  for (int i = 0; i < 500; i++) {
    FBT_INT_EQ(fb_rk4_step(&body, &state, &work, &input, &input, &input, (fb_real)dt), FB_OK);
  }
  FBT_INT_EQ(fb_body_momentum_eval(&body, &last, &state, NULL), FB_OK);
  for (int i = 0; i < 3; i++) {
    FBT_NEAR_ABS(last.linear[i], (double)first.linear[i] * exp(-drag * 0.5), FBT_TOL(1e-10, 1e-4));
    FBT_NEAR_ABS(last.angular[i], (double)first.angular[i] * exp(-drag * 0.5), FBT_TOL(2e-9, 1e-3));
  }
}

/* E14.40: springs to the origin, -spring r per mass, have the potential 1/2 spring sum m |r|^2. The energy of a free body
   in that field falls as dt^5 a time: positions at the stages of a step are those of O there. */
TEST(a_field_of_springs_conserves_energy)
{
  double loss[2];
  for (int k = 0; k < 2; k++) {
    static fb_rk4_work work;
    const double dt = 8e-4 / (1 + k), spring = 3.0;
    fb_state state;
    fb_input input;
    told user;
    double energy[2] = {0.0, 0.0};
    memset(&user, 0, sizeof user);
    user.spring = spring;
    line_make(0);
    level.base = FB_BASE_FREE;
    line_body(1.5);
    state_make(&state, 1.0);
    input = by_callback(&user);
    for (int i = 0; i <= 100 * (1 + k); i++) {
      if (i == 0 || i == 100 * (1 + k)) {
        const int at = i > 0;
        fb_motion motion;
        FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &input), FB_OK);
        FBT_INT_EQ(fb_body_lines_eval(&body, point, &n_point, &state, &motion, &input), FB_OK);
        energy[at] = energy_of(&state);
        for (int p = 0; p < n_point; p++) {
          energy[at] += 0.5 * spring * 0.9 * (double)point[p].at.length *
                        (double)fb_vec3_dot(point[p].at.position, point[p].at.position);
        }
      }
      FBT_INT_EQ(fb_rk4_step(&body, &state, &work, &input, &input, &input, (fb_real)dt), FB_OK);
    }
    loss[k] = fabs(energy[1] - energy[0]);
  }
  FBT_BELOW(loss[1], FBT_TOL(3e-7, 1e-2));
  FBT_TRUE(FB_SINGLE || loss[0] > 20.0 * loss[1]);
}

/* E14.41: points move as a node there does: the tip. */
TEST(points_of_lines_move_as_nodes)
{
  for (int k = 0; k < 4; k++) {
    fb_state state;
    fb_motion motion;
    fb_input input;
    fb_node_motion tip;
    fb_real R[9];
    line_make(1);
    if (k % 2) {
      line.attitude[0] = FB_R(0.6);
      line.attitude[1] = FB_R(0.48);
      line.attitude[2] = FB_R(0.64);
    }
    level.base = k < 2 ? FB_BASE_FREE : FB_BASE_PRESCRIBED;
    line_body(1.5);
    state_make(&state, 1.0);
    memset(&input, 0, sizeof input);
    input.w[1] = k < 2 ? FB_R(0.0) : FB_R(1.5);
    input.v[0] = k < 2 ? FB_R(0.0) : FB_R(0.7);
    input.w_dot[2] = k < 2 ? FB_R(0.0) : FB_R(2.0);
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &input), FB_OK);
    FBT_INT_EQ(fb_body_lines_eval(&body, point, &n_point, &state, &motion, &input), FB_OK);
    FBT_INT_EQ(fb_body_node_motion_eval(&body, &tip, &state, &motion, 1), FB_OK);
    fb_quat_to_mat33(R, tip.quat);
    for (int i = 0; i < 3; i++) {
      const fb_line_motion *const p = &point[n_point - 1];
      FBT_NEAR_ABS(p->at.position[i], tip.position[i], FBT_TOL(1e-13, 1e-5));
      FBT_NEAR_ABS(p->at.velocity[i], tip.velocity[i], FBT_TOL(1e-11, 1e-3));
      FBT_NEAR_ABS(p->at.angular_rate[i], tip.angular_rate[i], FBT_TOL(1e-10, 1e-3));
      FBT_NEAR_ABS(p->acceleration[i], tip.acceleration[i], FBT_TOL(5e-11, 1e-4) * fbt_largest(tip.acceleration, 3));
      FBT_NEAR_ABS(p->angular_acceleration[i], tip.angular_acceleration[i],
                   FBT_TOL(5e-11, 1e-4) * fbt_largest(tip.angular_acceleration, 3));
      for (int j = 0; j < 3 && k % 2 == 0; j++) {
        FBT_NEAR_ABS(p->at.R[3 * i + j], R[3 * i + j], FBT_TOL(1e-13, 1e-5));
      }
    }
  }
}

/* Interface: a callback that fails, or writes what is no number, ends the call and the state is as before; polynomial
   bodies have no lines. */
TEST(callbacks_that_fail_leave_the_state)
{
  static fb_rk4_work work;
  for (int k = 1; k <= 4; k++) {
    for (int sign = -1; sign <= 1; sign += 2) {
      fb_state state, before;
      fb_input input;
      told user;
      memset(&user, 0, sizeof user);
      user.fails = sign * k;
      line_make(0);
      level.base = FB_BASE_FREE;
      line_body(1.5);
      state_make(&state, 1.0);
      before = state;
      input = by_callback(&user);
      FBT_INT_EQ(fb_rk4_step(&body, &state, &work, &input, &input, &input, FB_R(1e-3)),
                 sign < 0 ? FB_ERR_NOT_FINITE : FB_ERR_CONVERGENCE);
      FBT_INT_EQ(user.calls, k);
      FBT_TRUE(memcmp(&state, &before, sizeof state) == 0);
    }
  }
  {
    fb_state state, rate;
    fb_motion motion;
    fb_input input;
    told user;
    int n;
    memset(&user, 0, sizeof user);
    line_make(0);
    level.effects = FB_EFFECTS_FULL;
    line_body(0.0);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    input = by_callback(&user);
    FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, &input), FB_ERR_UNSUPPORTED);
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, NULL), FB_OK);
    FBT_INT_EQ(fb_body_lines_eval(&body, point, &n, &state, &motion, NULL), FB_ERR_UNSUPPORTED);
    FBT_INT_EQ(user.calls, 0);
  }
}

/* ---- internal loads */

static void internal(const fb_state *state, fb_motion *motion, const fb_input *input)
{
  FBT_INT_EQ(fb_body_motion_eval(&body, motion, state, input), FB_OK);
  FBT_INT_EQ(fb_body_lines_eval(&body, point, &n_point, state, motion, input), FB_OK);
}

/* E14.41: a rod that turns about z is under the tension 1/2 m w^2 (L^2 - x^2) and what lumped bodies add, one that hangs
   under m g (L - x); by parts where mass per length steps. */
TEST(a_spinning_rod_is_under_its_tension)
{
  for (int k = 0; k < 4; k++) {
    const double spin = 7.0, g = 9.81, half = 0.9, light = k % 2 ? 0.3 : 0.9;
    fb_state state;
    fb_motion motion;
    fb_input input;
    line_make(0);
    line.n_element = 6;
    if (k % 2) { /* lighter behind the middle, a lumped body there and at the tip */
      line.n_station = 4;
      line.station[1] = line.station[2] = line.station[3] = line.station[0];
      line.station[1].x = FB_R(1.0) - (fb_real)FBT_TOL(1e-9, 1e-4);
      line.station[2].x = FB_R(1.0) + (fb_real)FBT_TOL(1e-9, 1e-4);
      line.station[3].x = FB_R(2.0);
      line.station[2].mass = line.station[3].mass = (fb_real)light;
      line.n_lump = 2;
      line.lump[0].node = 3;
      line.lump[0].mass = FB_R(0.5);
      line.lump[1].node = 6;
      line.lump[1].mass = FB_R(0.25);
    }
    level.effects = FB_EFFECTS_LARGE | FB_EFFECT_GRAVITY;
    level.gravity[0] = k < 2 ? FB_R(0.0) : (fb_real)g;
    line_body(0.0);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    memset(&input, 0, sizeof input);
    input.w[2] = k < 2 ? (fb_real)spin : FB_R(0.0);
    FBT_INT_EQ(fb_state_from_velocity(&body, &state, input.v, input.w, NULL), FB_OK);
    internal(&state, &motion, &input);
    for (int p = -2; p < n_point; p++) { /* nodes 2 and 1, then the points */
      fb_node_loads own;
      const double x = p >= 0 ? (double)point[p].at.x : p == -1 ? 2.0 : 0.7, inner = x < 1.0 ? 1.0 : x;
      const double lumps = k % 2 ? 0.25 * (k < 2 ? 2.0 : 1.0) + (x < 1.0 + 1e-5 ? 0.5 : 0.0) : 0.0;
      const double rod = k < 2 ? 0.5 * (light * (4.0 - inner * inner) + half * (inner * inner - x * x))
                               : light * (2.0 - inner) + half * (inner - x);
      const double tension = (rod + lumps) * (k < 2 ? spin * spin : g);
      if (p < 0) {
        FBT_INT_EQ(fb_body_node_loads_eval(&body, &own, &state, &motion, &input, -p), FB_OK);
      } else {
        memcpy(own.force, point[p].force, sizeof own.force);
        memcpy(own.moment, point[p].moment, sizeof own.moment);
      }
      FBT_NEAR_ABS(own.force[0], tension, FBT_TOL(1e-11, 1e-3) + (k % 2 ? FBT_TOL(1e-6, 1e-2) : 0.0));
      FBT_NEAR_ABS(own.force[1], 0.0, FBT_TOL(1e-11, 1e-3));
      FBT_NEAR_ABS(own.moment[2], 0.0, FBT_TOL(1e-11, 1e-3));
    }
  }
}

/* Loads in all axes at both nodes, along the line, by gravity and by a base that moves. */
static void anything_acts(fb_input *input, int axes)
{
  memset(input, 0, sizeof *input);
  for (int i = 0; i < 3; i++) {
    input->v[i] = (fb_real)(0.5 - 0.4 * i);
    input->w[i] = (fb_real)(0.7 * i - 1.0);
    input->v_dot[i] = (fb_real)(0.3 * i);
    input->w_dot[i] = (fb_real)(1.0 - 0.6 * i);
  }
  input->distributed = anything;
  input->n_load = 2;
  for (int l = 0; l < 2; l++) {
    input->load[l].node = 1 + l;
    input->load[l].axes = (fb_axes)((axes + l) % 3);
    for (int i = 0; i < 3; i++) {
      input->load[l].force[i] = (fb_real)(2.0 * cos(i + 2.0 * l));
      input->load[l].torque[i] = (fb_real)(0.3 * sin(i + 1.0 * l));
    }
  }
}

/* E14.41: nodes in the places of points have the internal loads of those points, roots, lumped bodies, twist and loads at
   nodes among them. (Between points: the closed forms around.) */
TEST(internal_loads_of_nodes_are_those_of_points)
{
  for (int k = 0; k < 4; k++) {
    fb_state state;
    fb_motion motion;
    fb_input input;
    fb_node_loads loads, before;
    line_make(k % 2);
    line.attitude[0] = FB_R(0.6);
    line.attitude[2] = FB_R(0.8);
    line.n_station = 2;
    line.station[1] = line.station[0];
    line.station[1].x = line.length;
    line.station[1].twist = k < 2 ? FB_R(0.0) : FB_R(0.8);
    level.effects = FB_EFFECTS_LARGE | FB_EFFECT_GRAVITY;
    level.gravity[1] = -FB_R(3.0);
    line_body(0.0);
    state_make(&state, 1.0);
    anything_acts(&input, k);
    internal(&state, &motion, &input);
    for (int p = 0; p < n_point; p++) {
      int node;
      shape.n_node = 3;
      FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, point[p].at.x), FB_OK);
      FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
      FBT_INT_EQ(fb_body_node_loads_eval(&body, &loads, &state, &motion, &input, 3), FB_OK);
      for (int i = 0; i < 3; i++) {
        FBT_NEAR_ABS(loads.force[i], point[p].force[i], FBT_TOL(1e-11, 1e-3));
        FBT_NEAR_ABS(loads.moment[i], point[p].moment[i], FBT_TOL(1e-11, 1e-3));
      }
    }
    before = loads;
    FBT_INT_EQ(fb_body_node_loads_eval(&body, &loads, &state, &motion, &input, 0), FB_ERR_UNSUPPORTED);
    FBT_INT_EQ(fb_body_node_loads_eval(&body, &loads, &state, &motion, &input, 4), FB_ERR_CAPACITY);
    FBT_INT_EQ(fb_body_node_loads_eval(&body, &loads, &state, &motion, &input, -1), FB_ERR_CAPACITY);
    FBT_TRUE(memcmp(&loads, &before, sizeof loads) == 0);
  }
}

/* E14.41: at the root, internal loads are what the base of a massless hub bears: its reactions, in a motion of any size
   under a distributed load, gravity and loads at nodes, in all axes. */
TEST(internal_loads_end_at_the_base)
{
  for (int k = 0; k < 6; k++) {
    fb_state state;
    fb_motion motion;
    fb_input input;
    fb_real R[9], F[3], M[3];
    line_make(k % 2);
    line.position[0] = FB_R(0.3);
    line.position[2] = -FB_R(0.2);
    if (k == 1) {
      line.attitude[0] = FB_R(0.6);
      line.attitude[2] = FB_R(0.8);
    }
    level.effects = FB_EFFECTS_LARGE | FB_EFFECT_GRAVITY;
    level.gravity[1] = -FB_R(3.0);
    line_body(0.0);
    state_make(&state, 1.0);
    anything_acts(&input, k / 2);
    internal(&state, &motion, &input);
    FBT_NEAR_ABS(point[0].at.x, 0.0, 0.0);

    /* section axes to inertial to body axes */
    fb_quat_to_mat33(R, state.quat);
    fb_mat33_mul_vec3(M, point[0].at.R, point[0].force);
    fb_mat33_mulT_vec3(F, R, M);
    fb_mat33_mul_vec3(point[0].force, point[0].at.R, point[0].moment);
    fb_mat33_mulT_vec3(M, R, point[0].force);
    for (int i = 0; i < 3; i++) {
      const int y = (i + 1) % 3, z = (i + 2) % 3;
      const double arm = (double)line.position[y] * (double)F[z] - (double)line.position[z] * (double)F[y];
      FBT_NEAR_ABS(motion.reaction_force[i], -F[i], FBT_TOL(1e-9, 2e-2));
      FBT_NEAR_ABS(motion.reaction_torque[i], -((double)M[i] + arm), FBT_TOL(1e-9, 2e-2));
    }
  }
}

/* E14.41, E8.31: a cantilever that a follower force at its tip has bent far is in equilibrium: its internal force is the
   load, its moment that load times the arm, and where a load mode represents it, EI times the curvature that a strain
   gauge reads: linear in q, exact for any deflection. */
TEST(internal_moments_bend_the_line)
{
  static fb_analyse_work work;
  fb_state state;
  fb_motion motion;
  fb_input input;
  fb_gauge gauge;
  fb_node_loads own;
  fb_node_motion at[2];
  double worst = 0.0, root = 0.0;
  line_make(0);
  line.n_element = 8;
  keep.count[FB_KIND_BEND_Z] = 0;
  keep.count[FB_KIND_BEND_Y] = 7;
  keep.n_load = 1;
  keep.load[0].node = 8;
  keep.load[0].axis = 1;
  line_body(0.0);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  memset(&input, 0, sizeof input);
  input.n_load = 1;
  input.load[0].node = 1;
  input.load[0].force[1] = FB_R(30.0); /* 4 EI/L^2 */
  FBT_INT_EQ(fb_body_trim(&body, &state, &work, &input), FB_OK);
  internal(&state, &motion, &input);
  FBT_TRUE(fabs((double)point[n_point - 1].at.position[1]) > 1.2); /* 60 % of its length */
  for (int p = 0; p < n_point; p++) {
    const double arm = (double)point[n_point - 1].at.position[0] - (double)point[p].at.position[0];
    double moment;
    FBT_NEAR_ABS(point[p].moment[2], 30.0 * arm, FBT_TOL(1e-8, 2e-2));
    FBT_NEAR_ABS(point[p].force[0], 30.0 * (double)point[p].at.R[3], FBT_TOL(1e-8, 1e-3)); /* 30 N along y */
    FBT_NEAR_ABS(point[p].force[1], 30.0 * (double)point[p].at.R[4], FBT_TOL(1e-8, 1e-3));
    FBT_INT_EQ(fb_gauge_init(&gauge, 0, &beam, &modes, point[p].at.x, FB_R(1.0), FB_R(0.0)), FB_OK);
    moment = -30.0 * (double)fb_gauge_eval(&gauge, state.q);
    worst = fmax(worst, fabs(moment - (double)point[p].moment[2]));
    root = fmax(root, fabs((double)point[p].moment[2]));
  }
  FBT_BELOW(worst, FBT_TOL(1e-3, 2e-2) * root);
  for (int node = 1; node <= 2; node++) {
    FBT_INT_EQ(fb_body_node_motion_eval(&body, &at[node - 1], &state, &motion, node), FB_OK);
    FBT_INT_EQ(fb_body_node_loads_eval(&body, &own, &state, &motion, &input, node), FB_OK);
    FBT_NEAR_ABS(own.moment[2], 30.0 * (double)(at[0].position[0] - at[node - 1].position[0]), FBT_TOL(1e-8, 2e-2));
  }
}

/* E8.7 with lines: damping takes the power q_dot^T C q_dot. */
TEST(damping_of_lines_takes_its_power)
{
  static fb_rk4_work work;
  const double dt = 2e-4;
  fb_state state;
  double energy, done = 0.0;
  line_make(1);
  level.effects = FB_EFFECTS_LARGE | FB_EFFECT_DAMPING;
  level.base = FB_BASE_FREE;
  for (int a = 0; a < 7; a++) {
    level.zeta[a] = FB_R(0.03);
  }
  line_body(1.5);
  state_make(&state, 1.0);
  energy = energy_of(&state);
  for (int i = 0; i <= 200; i++) {
    fb_motion motion;
    double power = 0.0;
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, NULL), FB_OK);
    for (int a = 0; a < body.n; a++) {
      power += (double)body.C.diagonal[a] * (double)motion.q_dot[a] * (double)motion.q_dot[a];
    }
    for (int t = 0; t < body.C.n_term; t++) {
      power += 2.0 * (double)body.C.term[t].c * (double)motion.q_dot[body.C.term[t].a] *
               (double)motion.q_dot[body.C.term[t].b];
    }
    done += (i == 0 || i == 200 ? 1.0 : i % 2 ? 4.0 : 2.0) * dt / 3.0 * power;
    if (i < 200) {
      FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, (fb_real)dt), FB_OK);
    }
  }
  FBT_TRUE(done > 1e-3);
  FBT_NEAR_REL(energy - energy_of(&state), done, FBT_TOL(1e-7, 1e-2));
}

/* Interface: the other forms have no terms for lines. */
TEST(other_forms_than_the_momentum_form_refuse_lines)
{
  static fb_form_body formed;
  line_make(0);
  line_body(0.0);
  for (int form = FBT_SECOND; form < FBT_FORMS; form++) {
    const fb_form_desc kind = {(fb_form)form, FB_TORQUE_IDENTITY, NULL};
    FBT_INT_EQ(fb_form_init(&formed, &body_work, &shape, &level, &kind), FB_ERR_EFFECTS);
  }
}

SUITE(line_loads, RUN(a_weight_by_callback_is_gravity), RUN(power_of_distributed_loads_is_the_rate_of_energy),
      RUN(drag_by_mass_slows_momenta_in_closed_form), RUN(a_field_of_springs_conserves_energy),
      RUN(points_of_lines_move_as_nodes), RUN(callbacks_that_fail_leave_the_state),
      RUN(a_spinning_rod_is_under_its_tension), RUN(internal_loads_end_at_the_base),
      RUN(internal_moments_bend_the_line), RUN(internal_loads_of_nodes_are_those_of_points),
      RUN(damping_of_lines_takes_its_power), RUN(other_forms_than_the_momentum_form_refuse_lines))
