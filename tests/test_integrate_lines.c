/* >>integrate: bodies with lines (FB_EFFECT_LARGE_DEFLECTION) by every integrator, their step limits and range. */
#include "integrate.h"

#define BENDING 3.79827 /* [rad/s] first bending frequency of the clamped boom, 3.516 sqrt(EI/m)/L^2 */

static const fb_base bases[] = {FB_BASE_FREE, FB_BASE_PINNED, FB_BASE_HINGED, FB_BASE_PRESCRIBED};
static fb_input still; /* prescribed base: its spin */

/* A boom whose beam is a line, 3 + 3 modes by plane: y 0, 2, 4, z 1, 3, 5. */
static void large_boom(fb_base base)
{
  boom(FB_EFFECTS_LARGE, base, 3, 3, 0, 0.0);
  memset(&still, 0, sizeof still);
}

/* Bent in the first mode of both planes, about `turn` radians at the tip in y, and spinning about z. */
static void bend(fb_state *state, double turn, double spin)
{
  const fb_real v[3] = {0}, w[3] = {0, 0, (fb_real)spin};
  FBT_INT_EQ(fb_state_init(&body, state), FB_OK);
  state->q[0] = (fb_real)(12.5 * turn);
  state->q[1] = (fb_real)(-8.0 * turn);
  FBT_INT_EQ(fb_state_from_velocity(&body, state, v, w, NULL), FB_OK);
  still.w[2] = (fb_real)spin;
}

static fb_status go(integrator which, fb_state *state, double dt)
{
  return step(which, state, &still, &still, &still, dt);
}

/* Angle by which the tip has turned against the frame [rad], up to pi. */
static double tip_angle(const fb_state *state)
{
  fb_motion motion;
  fb_node_motion tip;
  FBT_INT_EQ(fb_body_motion_eval(&body, &motion, state, &still), FB_OK);
  FBT_INT_EQ(fb_body_node_motion_eval(&body, &tip, state, &motion, 1), FB_OK);
  return sqrt((double)(tip.rotation[0] * tip.rotation[0] + tip.rotation[1] * tip.rotation[1] +
                       tip.rotation[2] * tip.rotation[2]));
}

static double apart(const fb_state *a, const fb_state *b)
{
  return fbt_difference(a->q, b->q, body.n);
}

/* Runs to time T from the bent state. */
static void run_to(fb_state *state, integrator which, int steps, double T, double turn, double spin)
{
  fb_status status = FB_OK;
  bend(state, turn, spin);
  prepare(which, T / steps);
  for (int k = 0; k < steps && status == FB_OK; k++) {
    status = go(which, state, T / steps);
  }
  FBT_INT_EQ(status, FB_OK);
}

/* E11.3, E11.4, E11.5, E11.7, E11.8, E11.10: errors at 1.2 rad of the tip fall as the textbook says, on every base. */
TEST(each_integrator_keeps_its_order_when_lines_bend_far)
{
  static const double order[] = {4.0, 2.0, 2.0, 4.0};
  static const int steps[] = {320, 80, 80, 640};
  for (int b = 0; b < 4; b++) {
    fb_state fine;
    large_boom(bases[b]);
    body.allow_long_step = 1;
    run_to(&fine, RK4, FBT_TOL(4000, 500), 0.5, 1.2, 0.3);
    for (int which = RK4; which < INTEGRATORS; which++) {
      fb_state coarse, half;
      if (FB_SINGLE && order[which] > 2.0) { /* round-off hides the fourth order */
        run_to(&coarse, (integrator)which, steps[which], 0.5, 1.2, 0.3);
        FBT_BELOW(apart(&coarse, &fine), 1e-2);
        continue;
      }
      run_to(&coarse, (integrator)which, steps[which], 0.5, 1.2, 0.3);
      run_to(&half, (integrator)which, 2 * steps[which], 0.5, 1.2, 0.3);
      if (which == EXPONENTIAL) { /* its stiff order comes on top */
        FBT_BELOW(order[which] - 0.3, log2(apart(&coarse, &fine) / apart(&half, &fine)));
      } else {
        FBT_NEAR_ABS(log2(apart(&coarse, &fine) / apart(&half, &fine)), order[which], FBT_TOL(0.3, 0.4));
      }
    }
  }
}

/* A load per length that turns with the sections and pulses, and drag: what presses [N/m], drags [N s/m^2]. */
static struct {
  double press, drag;
} wind;

static fb_status blow(fb_line_point *point, int n, fb_real t, void *user)
{
  for (int k = 0; k < n; k++) {
    for (int i = 0; i < 3; i++) {
      const double along = (double)point[k].R[3 * i + 1], speed = (double)point[k].velocity[i];
      point[k].force[i] = point[k].length * (fb_real)(wind.press * sin(3.0 * (double)t) * along - wind.drag * speed);
    }
  }
  (void)user;
  return FB_OK;
}

/* Runs in that wind to time T from the bent state; the status of the step that ends it. */
static fb_status blown(fb_state *state, integrator which, int steps, double T, int iterations)
{
  const double dt = T / steps;
  fb_status status = FB_OK;
  fb_input in[3];
  bend(state, 0.4, 0.3);
  prepare(which, dt);
  for (int k = 0; k < steps && status == FB_OK; k++) {
    const fb_state before = *state;
    for (int i = 0; i < 3; i++) {
      in[i] = still;
      in[i].distributed = blow;
      in[i].t = (fb_real)((k + 0.5 * i) * dt);
    }
    status = which == MIDPOINT ? fb_midpoint_step(&body, state, &implicit_work, &in[1], (fb_real)dt, iterations)
             : which == SDIRK  ? fb_sdirk_step(&body, state, &implicit_work, &in[0], &in[2], (fb_real)dt, iterations)
                               : step(which, state, &in[0], &in[1], &in[2], dt);
    FBT_TRUE(status == FB_OK || memcmp(&before, state, sizeof before) == 0);
  }
  return status;
}

/* E11.3, E11.4, E11.7, E11.8, E11.10, E14.40: so they do under loads along the line that follow it, drag and pulse. */
TEST(each_integrator_keeps_its_order_under_distributed_loads)
{
  static const double order[] = {4.0, 2.0, 2.0, 4.0};
  static const int steps[] = {320, 160, 160, 80};
  wind.press = 15.0;
  wind.drag = 0.3;
  for (int b = 0; b < 4; b++) {
    fb_state fine;
    large_boom(bases[b]);
    body.allow_long_step = 1;
    FBT_INT_EQ(blown(&fine, RK4, FBT_TOL(4000, 500), 0.5, 0), FB_OK);
    for (int which = RK4; which < INTEGRATORS; which++) {
      fb_state coarse, half;
      FBT_INT_EQ(blown(&coarse, (integrator)which, steps[which], 0.5, 0), FB_OK);
      if (FB_SINGLE && order[which] > 2.0) {
        FBT_BELOW(apart(&coarse, &fine), 1e-2);
        continue;
      }
      FBT_INT_EQ(blown(&half, (integrator)which, 2 * steps[which], 0.5, 0), FB_OK);
      FBT_NEAR_ABS(log2(apart(&coarse, &fine) / apart(&half, &fine)), order[which], FBT_TOL(0.25, 0.4));
    }
  }
}

/* E11.25: loads are not in the Newton matrix. Strong ones, up to 20 times what bends the boom by half its length, make
   iterations contract less; steps that end well have the error of their order all the same, the others say so and leave
   the state as it was. */
TEST(implicit_steps_under_strong_loads_are_right_or_refused)
{
  int refused = 0;
  wind.drag = 0.0;
  for (int strong = 0; strong < 3; strong++) {
    fb_state fine;
    wind.press = strong == 0 ? 20.0 : strong == 1 ? 80.0 : 300.0;
    large_boom(FB_BASE_PRESCRIBED);
    body.allow_long_step = 1;
    FBT_INT_EQ(blown(&fine, RK4, FBT_TOL(4000, 2000), 0.5, 0), FB_OK);
    body.allow_long_step = 0;
    for (int which = MIDPOINT; which <= SDIRK; which++) {
      for (int steps = 4; steps <= 64; steps *= 4) {
        fb_state few, many;
        const fb_status two = blown(&few, (integrator)which, steps, 0.5, 2);
        const fb_status eight = blown(&many, (integrator)which, steps, 0.5, 8);
        const double bound = FBT_TOL(8.0, 10.0) / (steps * steps);
        FBT_TRUE(two == FB_OK || two == FB_ERR_CONVERGENCE || two == FB_ERR_STEP || two == FB_ERR_RANGE);
        FBT_TRUE(eight == FB_OK || eight == FB_ERR_CONVERGENCE || eight == FB_ERR_STEP || eight == FB_ERR_RANGE);
        FBT_TRUE(two != FB_OK || apart(&few, &fine) < bound);
        FBT_TRUE(eight != FB_OK || apart(&many, &fine) < bound);
        refused += two == FB_ERR_CONVERGENCE;
      }
    }
  }
  FBT_TRUE(refused > 0);
}

/* E11.7: the energy of bent lines swings within a bound that falls with the square of the step and does not grow. */
TEST(midpoint_bounds_the_energy_of_bent_lines)
{
  for (int b = 0; b < 4; b++) {
    double worst[2] = {0.0, 0.0}, late = 0.0;
    large_boom(bases[b]);
    for (int fine = 0; fine < 2; fine++) {
      const int steps = FBT_LONG(3000, 400) * (fine + 1);
      const double dt = 0.02 / BENDING / (fine + 1);
      double energy;
      fb_state state;
      bend(&state, 1.0, 0.0);
      energy = energy_of(&state);
      for (int k = 0; k < steps; k++) {
        double miss;
        FBT_INT_EQ(go(MIDPOINT, &state, dt), FB_OK);
        miss = fabs(energy_of(&state) / energy - 1.0);
        worst[fine] = fmax(worst[fine], miss);
        late = fine && k > steps / 2 ? fmax(late, miss) : late;
      }
    }
    FBT_BELOW(worst[0], 0.02);
    FBT_BELOW(worst[1], FBT_TOL(0.5, 0.6) * worst[0]);
    FBT_BELOW(late, 1.5 * worst[1] + FBT_TOL(0, 1e-4));
  }
}

/* E11.30, E14.13: many free steps keep both momenta to rounding, and the energy as far as rk4 does. */
TEST(bent_lines_keep_their_momenta_over_many_steps)
{
  const int steps = FBT_LONG(100000, 2000);
  fb_momentum before, after;
  fb_state state;
  double energy, size;
  large_boom(FB_BASE_FREE);
  bend(&state, 1.0, 0.5);
  state.u[0] = FB_R(1.5);
  state.u[1] = -FB_R(0.5);
  energy = energy_of(&state);
  FBT_INT_EQ(fb_body_momentum_eval(&body, &before, &state, NULL), FB_OK);
  for (int k = 0; k < steps; k++) {
    FBT_INT_EQ(go(RK4, &state, 0.001), FB_OK);
  }
  FBT_INT_EQ(fb_body_momentum_eval(&body, &after, &state, NULL), FB_OK);
  size = fbt_largest(before.angular, 3) + 10.0 * fbt_largest(before.linear, 3);
  FBT_BELOW(fbt_difference(before.linear, after.linear, 3), FBT_TOL(1e-12, 1e-5) * size);
  FBT_BELOW(fbt_difference(before.angular, after.angular, 3), FBT_TOL(1e-10, 2e-3) * size);
  FBT_NEAR_REL(energy_of(&state), energy, FBT_TOL(1e-5, 1e-2));
  FBT_INT_EQ(fb_state_check(&body, &state), FB_OK);
}

/* Largest step that rk4 does not refuse from this state. */
static double longest(const fb_state *state)
{
  double low = 1e-5, high = 10.0;
  for (int i = 0; i < 50; i++) {
    const double dt = sqrt(low * high);
    fb_state trial = *state;
    const fb_status status = go(RK4, &trial, dt);
    low = status == FB_ERR_STEP ? low : dt;
    high = status == FB_ERR_STEP ? dt : high;
  }
  return low;
}

/* Largest |lambda| of the equations of motion linearized at a state, over q, pi and h, by central differences. */
static double fastest(const fb_state *state)
{
  enum { MOST = 2 * FB_MAX_MODES + 3 };
  static fb_real A[MOST * MOST], X[2 * MOST * MOST], scratch[4 * MOST * MOST], re[MOST], im[MOST];
  const int n = body.n, rigid = body.base == FB_BASE_PRESCRIBED ? 0 : 3, size = 2 * n + rigid;
  double most = 0.0;
  for (int c = 0; c < size; c++) {
    const fb_real h = (fb_real)FBT_TOL(1e-5, 1e-2);
    fb_state plus = *state, minus = *state, up, down;
    fb_real *const p = c < n ? &plus.q[c] : c < 2 * n ? &plus.pi[c - n] : &plus.L[c - 2 * n];
    fb_real *const m = c < n ? &minus.q[c] : c < 2 * n ? &minus.pi[c - n] : &minus.L[c - 2 * n];
    *p += body.base == FB_BASE_HINGED && c >= 2 * n && c < 2 * n + 2 ? FB_R(0.0) : h;
    *m -= body.base == FB_BASE_HINGED && c >= 2 * n && c < 2 * n + 2 ? FB_R(0.0) : h;
    FBT_INT_EQ(fb_body_rates_eval(&body, &up, &plus, &still), FB_OK);
    FBT_INT_EQ(fb_body_rates_eval(&body, &down, &minus, &still), FB_OK);
    for (int r = 0; r < size; r++) {
      const fb_real a = r < n ? up.q[r] : r < 2 * n ? up.pi[r - n] : up.h[r - 2 * n];
      const fb_real b = r < n ? down.q[r] : r < 2 * n ? down.pi[r - n] : down.h[r - 2 * n];
      A[r * size + c] = (a - b) / (FB_R(2.0) * h);
    }
  }
  FBT_INT_EQ(fb_eig_general_solve(re, im, X, A, scratch, size), FB_OK);
  for (int i = 0; i < size; i++) {
    most = fmax(most, hypot((double)re[i], (double)im[i]));
  }
  return most;
}

/* E11.36, E11.37: against the eigenvalues of the equations linearized at random shapes of up to 1.5 rad, on every base,
   beside a lighter and a heavier hub: the limit is never beyond stability and at most 15 % below, at rest. The
   undeformed body's may be twice too long. */
TEST(rk4_limits_hold_for_bent_lines)
{
  double least = HUGE_VAL, ratio = HUGE_VAL;
  for (int b = 0; b < 8; b++) {
    large_boom(bases[b % 4]);
    if (b < 4) { /* a light hub */
      const fb_real center[3] = {0}, inertia[6] = {FB_R(0.5), FB_R(0.5), FB_R(0.5), 0, 0, 0};
      int tip;
      FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
      FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(2.0), center, inertia), FB_OK);
      FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
      FBT_INT_EQ(fb_shape_add_beam_node(&shape, &tip, 0, &beam, &modes, FB_R(10.0)), FB_OK);
      FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &body_desc), FB_OK);
    }
    for (int k = 0; k < 12; k++) {
      fb_state state;
      double product;
      bend(&state, 0.0, 0.0);
      for (int a = 0; a < body.n; a++) {
        state.q[a] = (fb_real)(fbt_random() * 9.0 / (1.0 + 4.0 * (a / 2) * (a / 2)));
      }
      for (int i = 0; i < 8 && fb_state_check(&body, &state) == FB_OK; i++) {
        const double size = (0.3 + 0.1 * k) / tip_angle(&state);
        for (int a = 0; a < body.n; a++) {
          state.q[a] *= (fb_real)size;
        }
      }
      if (fb_state_check(&body, &state) != FB_OK || tip_angle(&state) > 1.5) {
        continue;
      }
      product = longest(&state) * fastest(&state);
      FBT_BELOW(product, 2.785 * (1.0 + FBT_TOL(1e-5, 1e-2)));
      least = fmin(least, body.base == FB_BASE_PRESCRIBED ? product / 2.785 : 1.0); /* others may turn too far */
      ratio = fmin(ratio, 2.785 / fastest(&state) / (double)fb_rk4_limit(&body, 0, 0));
    }
  }
  FBT_TRUE(least > 0.85);
  FBT_BELOW(ratio, 0.7);
}

/* E11.37: what fb_rk4_limit allows an undeformed body at rest, spinning and damped, the step allows; not more. */
TEST(undeformed_lines_have_the_limit_of_their_function)
{
  for (int b = 0; b < 4; b++) {
    fb_state state;
    boom(FB_EFFECTS_LARGE | FB_EFFECT_DAMPING, bases[b], 3, 3, 0, b % 2 ? 0.02 : 0.0);
    memset(&still, 0, sizeof still);
    bend(&state, 0.0, 0.0);
    FBT_NEAR_REL(longest(&state), fb_rk4_limit(&body, 0, 0), FBT_TOL(1e-9, 1e-4));
  }
}

/* E11.37: steps of 0.98 of what each state allows, while bent lines swing: no energy comes in. */
TEST(steps_of_bent_lines_within_the_limit_are_stable)
{
  for (int b = 0; b < 4; b++) {
    fb_state state;
    double energy;
    large_boom(bases[b]);
    bend(&state, 1.0, 0.0);
    energy = energy_of(&state);
    for (int k = 0; k < FBT_LONG(400, 40); k++) {
      FBT_INT_EQ(go(RK4, &state, 0.98 * longest(&state)), FB_OK);
      FBT_BELOW(energy_of(&state), (1.001 + 1e-5 * k) * energy);
    }
  }
}

/* What `iterations` of the midpoint rule miss of all of them. */
static double missing(const fb_state *state, double dt, int iterations)
{
  fb_state some = *state, all = *state;
  FBT_INT_EQ(fb_midpoint_step(&body, &all, &implicit_work, &still, (fb_real)dt, 40), FB_OK);
  FBT_INT_EQ(fb_midpoint_step(&body, &some, &implicit_work, &still, (fb_real)dt, iterations), FB_OK);
  return apart(&some, &all);
}

/* E11.38: with lines at 1 rad that spin at ten times their first frequency, near |w| dt = 1/10, an iteration shrinks
   the error twelvefold on every base; without the derivatives of the lines' inertia it shrinks by a half, and steps
   within the limit do not converge. */
TEST(newton_contracts_with_lines)
{
  for (int b = 0; b < 4; b++) {
    const double spin = 10.0 * BENDING, dt = 0.09 / spin;
    fb_state state;
    large_boom(bases[b]);
    body.allow_long_step = 1;
    bend(&state, 0.8, spin);
    for (int k = 0; k < 100; k++) {
      if (k % 10 == 0) {
        const double one = missing(&state, dt, 1), three = missing(&state, dt, 3);
        FBT_BELOW(three, one / 144.0 + FBT_TOL(1e-12, 1e-4));
      }
      FBT_INT_EQ(go(MIDPOINT, &state, dt), FB_OK);
    }
  }
}

/* E11.8: steps of a thousand periods of the highest mode, and of fifty of the lowest, under a dead force that grows to
   P = EI/L^2: the elastica, tip displacements 0.30172 and 0.05643 of the length (Mattiasson 1981). */
TEST(long_steps_find_the_elastica)
{
  fb_state state;
  fb_input input[2];
  fb_motion motion;
  fb_node_motion tip;
  double dt;
  large_boom(FB_BASE_PRESCRIBED);
  dt = 1000.0 * 2.0 * 3.14159265358979 / sqrt((double)body.limit_elastic);
  memset(input, 0, sizeof input);
  for (int i = 0; i < 2; i++) {
    input[i].n_load = 1;
    input[i].load[0].node = 1;
    input[i].load[0].axes = FB_AXES_INERTIAL;
  }
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  for (int k = 0; k < 40; k++) {
    for (int i = 0; i < 2; i++) {
      input[i].load[0].force[1] = FB_R(140.04) * (fb_real)fmin(1.0, (k + i) / 30.0);
    }
    FBT_INT_EQ(fb_sdirk_step(&body, &state, &implicit_work, &input[0], &input[1], (fb_real)dt, 8), FB_OK);
  }
  FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &input[1]), FB_OK);
  FBT_INT_EQ(fb_body_node_motion_eval(&body, &tip, &state, &motion, 1), FB_OK);
  FBT_NEAR_ABS(tip.displacement[1], 3.0172, 0.01);
  FBT_NEAR_ABS(tip.displacement[0], -0.5643, 0.005);
  FBT_BELOW(fbt_largest(motion.q_dot, body.n), FBT_TOL(1e-6, 1e-2));
}

/* E11.4, E11.8: steps long against the highest mode, which the implicit integrators need not resolve, follow the slow
   swing of the first one. */
TEST(implicit_steps_follow_the_slow_swing_of_bent_lines)
{
  for (int which = MIDPOINT; which <= SDIRK; which++) {
    const double T = 1.0;
    fb_state fine, coarse;
    large_boom(FB_BASE_PRESCRIBED);
    run_to(&fine, RK4, 1000, T, 0.8, 0.0);
    run_to(&coarse, (integrator)which, 20, T, 0.8, 0.0); /* 3.3 rad of the highest mode a step */
    FBT_TRUE(T / 20 > (double)fb_rk4_limit(&body, 0, 0));
    FBT_BELOW(apart(&fine, &coarse), 0.03 * 10.0);
  }
}

/* E11.4, E14.13: a spin of ten times the first frequency; all integrators agree, free motion keeps its energy. */
TEST(lines_spin_at_ten_times_their_frequency)
{
  for (int b = 0; b < 4; b++) {
    const double spin = 10.0 * BENDING;
    fb_state fine;
    large_boom(bases[b]);
    body.allow_long_step = 1;
    run_to(&fine, RK4, 2000, 0.1, 0.3, spin);
    for (int which = RK4; which < INTEGRATORS; which++) {
      fb_state state;
      run_to(&state, (integrator)which, 200, 0.1, 0.3, spin);
      FBT_BELOW(apart(&state, &fine), FBT_TOL(which == RK4 || which == EXPONENTIAL ? 1e-4 : 2e-2, 4e-2));
    }
  }
}

/* E14.3: a tip that points backwards, past 180 degrees: every integrator lets it go and all agree. */
TEST(tips_swing_past_half_a_turn)
{
  fb_state fine, state;
  double energy;
  large_boom(FB_BASE_PRESCRIBED);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  state.q[0] = FB_R(38.0);
  FBT_TRUE(tip_angle(&state) > 2.8);
  state.q[0] = FB_R(44.0);
  FBT_TRUE(tip_angle(&state) < 3.0); /* beyond half a turn the shorter way round is the other one */
  FBT_INT_EQ(fb_state_check(&body, &state), FB_OK);
  energy = energy_of(&state);
  body.allow_long_step = 1;
  for (int which = RK4; which < INTEGRATORS; which++) {
    fb_state next = state;
    const int steps = 400;
    prepare((integrator)which, 0.1 / steps);
    for (int k = 0; k < steps; k++) {
      FBT_INT_EQ(go((integrator)which, &next, 0.1 / steps), FB_OK);
    }
    FBT_NEAR_REL(energy_of(&next), energy, FBT_TOL(1e-3, 3e-3));
    if (which == RK4) {
      fine = next;
    }
    FBT_BELOW(apart(&next, &fine), 0.02);
  }
}

/* E11.39: what bends far within a step of the exponential integrator is refused, what bends little is not, and what is
   not refused gains no energy. */
TEST(exponential_steps_know_the_deflection)
{
  for (int b = 0; b < 4; b++) {
    const double dt = 2.0 / sqrt((double)3600.0);
    fb_state state, before;
    double energy;
    large_boom(bases[b]);
    prepare(EXPONENTIAL, dt);
    bend(&state, 1.2, 0.0);
    before = state;
    FBT_INT_EQ(go(EXPONENTIAL, &state, dt), FB_ERR_STEP);
    FBT_TRUE(memcmp(&state, &before, sizeof state) == 0);
    bend(&state, 0.01, 0.0);
    energy = energy_of(&state);
    for (int k = 0; k < 3000; k++) {
      FBT_INT_EQ(go(EXPONENTIAL, &state, dt), FB_OK);
      FBT_NEAR_REL(energy_of(&state), energy, 0.01);
    }
  }
}

/* E14.2: an interval that turns too far is refused by the check of the state, by every step, and by rates, alike. */
TEST(intervals_of_lines_turn_so_far_and_no_farther)
{
  double low = 0.0, high = 1000.0;
  fb_state state;
  large_boom(FB_BASE_PRESCRIBED);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  for (int i = 0; i < 60; i++) {
    const double q = 0.5 * (low + high);
    state.q[2] = (fb_real)q;
    low = fb_state_check(&body, &state) == FB_OK ? q : low;
    high = fb_state_check(&body, &state) == FB_OK ? high : q;
  }
  for (int beyond = 0; beyond < 2; beyond++) {
    fb_state rate;
    state.q[2] = (fb_real)(low * (beyond ? 1.0001 : 0.9999));
    FBT_INT_EQ(fb_state_check(&body, &state), beyond ? FB_ERR_RANGE : FB_OK);
    FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, NULL), beyond ? FB_ERR_RANGE : FB_OK);
#if FB_WITH_DETAIL
    if (beyond) {
      FBT_TRUE(fb_detail_last()->index >= 0 && fb_detail_last()->index < body.lines.n_point);
      FBT_NEAR_REL(fb_detail_last()->have, sqrt(1.5), 2e-4);
      FBT_NEAR_REL(fb_detail_last()->need, sqrt(1.5), 1e-6);
    }
#endif
    for (int which = RK4; which < INTEGRATORS && beyond; which++) {
      fb_state next = state;
      prepare((integrator)which, 1e-4);
      FBT_INT_EQ(go((integrator)which, &next, 1e-4), FB_ERR_RANGE);
      FBT_TRUE(memcmp(&next, &state, sizeof state) == 0);
    }
  }
}

/* The same about the longest step that is taken, where the last stage is in range and the end may not be. */
static void longest_step(const fb_state *from, double high)
{
  double low = 0.0;
  for (int k = 0; k < 40; k++) {
    const double dt = 0.5 * (low + high);
    fb_state next = *from;
    const fb_status status = go(RK4, &next, dt);
    FBT_INT_EQ(fb_state_check(&body, &next), FB_OK);
    low = status == FB_OK ? dt : low;
    high = status == FB_OK ? high : dt;
  }
  FBT_TRUE(low > 0.0);
}

/* E14.2: flung lines: whatever a step commits the check accepts, up to the step that is refused. */
TEST(committed_states_of_lines_pass_their_check)
{
  for (int which = RK4; which < INTEGRATORS; which++) {
    for (int b = 0; b < 4; b++) {
      fb_status status = FB_OK;
      fb_state state, before;
      int k;
      large_boom(bases[b]);
      body.allow_long_step = 1;
      prepare((integrator)which, 2e-4);
      bend(&state, 0.5, 0.0);
      state.pi[2] = FB_R(12000.0);
      for (k = 0; k < 3000 && status == FB_OK; k++) {
        before = state;
        status = go((integrator)which, &state, 2e-4);
        FBT_INT_EQ(fb_state_check(&body, &state), FB_OK);
        FBT_TRUE(status == FB_OK || memcmp(&state, &before, sizeof state) == 0);
      }
      FBT_TRUE(status == FB_ERR_RANGE || status == FB_ERR_STEP || status == FB_ERR_CONVERGENCE);
      if (which == RK4) {
        longest_step(&before, 2e-4);
      }
    }
  }
}

/* E11.3, E11.7, E11.8, E11.10: fb_stepper takes the same steps with lines, to the bit. */
TEST(steppers_take_the_steps_of_lines)
{
  static fb_stepper stepper;
  for (int which = RK4; which < INTEGRATORS; which++) {
    const double dt = which == EXPONENTIAL ? 1e-4 : 0.004;
    fb_stepper_desc desc;
    fb_state direct, stepped;
    large_boom(FB_BASE_FREE);
    prepare((integrator)which, dt);
    bend(&direct, 0.7, 0.4);
    stepped = direct;
    memset(&desc, 0, sizeof desc);
    desc.body = &body;
    desc.state = &stepped;
    desc.integrator = (fb_integrator)which;
    desc.exponential = which == EXPONENTIAL ? &exponential : NULL;
    desc.dt = (fb_real)dt;
    FBT_INT_EQ(fb_stepper_init(&stepper, &desc), FB_OK);
    for (int k = 0; k < 50; k++) {
      FBT_INT_EQ(step((integrator)which, &direct, NULL, NULL, NULL, dt), FB_OK);
      FBT_INT_EQ(fb_stepper_step(&stepper), FB_OK);
    }
    FBT_TRUE(memcmp(&direct, &stepped, sizeof direct) == 0);
  }
}

/* Interface: works hold states and matrices and nothing of the lines, and what they held before a step does not matter. */
TEST(works_hold_nothing_of_lines)
{
  fb_rk4_work work;
  FBT_TRUE(sizeof(fb_rk4_work) == 4 * sizeof(fb_state));
  FBT_TRUE(sizeof(fb_exponential_work) == 11 * sizeof(fb_state));
  large_boom(FB_BASE_FREE);
  for (int which = RK4; which < INTEGRATORS; which++) {
    fb_state after[2];
    prepare((integrator)which, 1e-4);
    for (int k = 0; k < 2; k++) {
      bend(&after[k], 0.7, 0.4);
      memset(&work, k ? 0xFF : 0, sizeof work);
      memset(&implicit_work, k ? 0xFF : 0, sizeof implicit_work);
      memset(&exponential_work, k ? 0xFF : 0, sizeof exponential_work);
      FBT_INT_EQ(which == RK4 ? fb_rk4_step(&body, &after[k], &work, NULL, NULL, NULL, FB_R(1e-4))
                              : step((integrator)which, &after[k], NULL, NULL, NULL, 1e-4),
                 FB_OK);
    }
    FBT_TRUE(memcmp(&after[0], &after[1], sizeof after[0]) == 0);
  }
}

/* E11.22: a pinned or hinged base holds O: neither u nor what rounding keeps of it may differ from zero, for the check
   and for every step, with and without lines. */
TEST(pins_hold_what_rounding_keeps)
{
  for (int k = 0; k < 8; k++) {
    const fb_base base = k % 2 ? FB_BASE_PINNED : FB_BASE_HINGED;
    boom(k < 4 ? FB_EFFECTS_FULL : FB_EFFECTS_LARGE, base, 2, 2, 0, 0.0);
    memset(&still, 0, sizeof still);
    for (int which = RK4; which < INTEGRATORS; which++) {
      fb_state state, before;
      FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
      prepare((integrator)which, 1e-3);
      FBT_INT_EQ(go((integrator)which, &state, 1e-3), FB_OK);
      (k & 2 ? state.u : state.lost_u)[which % 3] = FB_R(0.1);
      before = state;
      FBT_INT_EQ(fb_state_check(&body, &state), FB_ERR_VALUE);
      FBT_INT_EQ(go((integrator)which, &state, 1e-3), FB_ERR_VALUE);
      FBT_TRUE(memcmp(&state, &before, sizeof state) == 0);
    }
  }
}

SUITE(integrate_lines, RUN_LONG(each_integrator_keeps_its_order_when_lines_bend_far),
      RUN_LONG(each_integrator_keeps_its_order_under_distributed_loads),
      RUN_LONG(implicit_steps_under_strong_loads_are_right_or_refused), RUN(midpoint_bounds_the_energy_of_bent_lines),
      RUN(bent_lines_keep_their_momenta_over_many_steps), RUN(rk4_limits_hold_for_bent_lines),
      RUN(undeformed_lines_have_the_limit_of_their_function), RUN(steps_of_bent_lines_within_the_limit_are_stable),
      RUN(newton_contracts_with_lines), RUN(long_steps_find_the_elastica),
      RUN(implicit_steps_follow_the_slow_swing_of_bent_lines), RUN(lines_spin_at_ten_times_their_frequency),
      RUN(tips_swing_past_half_a_turn), RUN(exponential_steps_know_the_deflection),
      RUN(intervals_of_lines_turn_so_far_and_no_farther), RUN(committed_states_of_lines_pass_their_check),
      RUN(steppers_take_the_steps_of_lines), RUN(works_hold_nothing_of_lines), RUN(pins_hold_what_rounding_keeps))
