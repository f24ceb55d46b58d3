/* >>advise: bodies with rotors: what turning wheels do to modes and steps, against simulations of all models of a small
   ladder. */
#include "advise.h"
#if FB_WITH_ROTORS

static fb_shape other;
static double moved;  /* [m] the most of the output, of all modes and effects */
static fb_real pitch; /* [N m s] of its wheel at the start */
static fb_body twin;
static fb_body_work body_work;

#define SWINGS 80
#define WHEELS 3

/* A hub with two booms, and wheels along roll, pitch and yaw; the first boom's tip is the output. A motor turns the craft
   by its yaw wheel, as one period of a sine; the pitch wheel has the momentum h. */
static void make_wheels(int modes, double h)
{
  make_two_booms(modes, modes);
  level.n_rotor = WHEELS;
  for (int r = 0; r < WHEELS; r++) {
    level.rotor[r].axis[r] = FB_R(1.0);
    level.rotor[r].inertia = FB_R(0.02);
  }
  envelope.n_load = 0;
  envelope.frequency = FB_R(0.7854);
  envelope.duration = FB_R(20.0);
  envelope.frame = FB_R(0.25);
  pitch = (fb_real)h;
  envelope.rotor[2].torque = FB_R(6.0);
}

/* x takes the value that is farther from zero. */
static void widen(fb_real *x, fb_real value)
{
  *x = fabs((double)value) > fabs((double)*x) ? value : *x;
}

/* Displacement of the output; candidate NULL: that of a rigid body, whose extremes go to the envelope. */
static fb_status swing(fb_real *out, const fb_advice *candidate)
{
  static fb_rk4_work rk4;
  static fb_implicit_work implicit;
  static fb_exponential exponential;
  static fb_exponential_work scratch;
  fb_envelope most = envelope;
  fb_input input[3];
  fb_state state;
  fb_motion motion;
  fb_node_motion tip;
  const fb_real wanted = candidate ? candidate->dt : FB_R(0.01);
  const int steps = (int)lround((double)envelope.duration / SWINGS / (double)wanted), n = candidate ? candidate->n : 0;
  const fb_real dt = envelope.duration / (fb_real)(SWINGS * steps);
  const fb_real first[WHEELS] = {0, pitch, 0};
  fb_status status = fb_shape_select(&other, &shape, candidate ? candidate->coordinate : NULL, n);
  fb_body_desc desc = level;
  desc.effects = candidate ? candidate->effects : FB_EFFECTS_RIGID;
  memset(input, 0, sizeof input);
  status = status ? status : fb_body_init(&twin, &body_work, &other, &desc);
  status = status ? status : fb_state_init(&twin, &state);
  for (int r = 0; r < WHEELS && status == FB_OK; r++) {
    status = fb_state_rotor_set(&twin, &state, r, first[r] / twin.rotor[r].inertia, 0, NULL);
  }
  if (status == FB_OK && candidate && candidate->integrator == FB_INTEGRATOR_EXPONENTIAL) {
    status = fb_exponential_init(&exponential, &body_work, &twin, dt);
  }
  for (int k = 0; k < SWINGS * steps && status == FB_OK; k++) {
    const fb_integrator integrator = candidate ? candidate->integrator : FB_INTEGRATOR_RK4;
    for (int j = 0; j < 3; j++) {
      const double phase = 0.7854 * ((double)k + 0.5 * j) * (double)dt;
      input[j].rotor[2].torque = phase < 6.2831853 ? envelope.rotor[2].torque * (fb_real)sin(phase) : FB_R(0.0);
    }
    status = integrator == FB_INTEGRATOR_RK4        ? fb_rk4_step(&twin, &state, &rk4, input, input + 1, input + 2, dt)
             : integrator == FB_INTEGRATOR_MIDPOINT ? fb_midpoint_step(&twin, &state, &implicit, input + 1, dt, 0)
             : integrator == FB_INTEGRATOR_SDIRK
                 ? fb_sdirk_step(&twin, &state, &implicit, input, input + 2, dt, 0)
                 : fb_exponential_step(&twin, &exponential, &state, &scratch, input, input + 1, input + 2);
    status = status ? status : fb_body_motion_eval(&twin, &motion, &state, input + 2);
    for (int i = 0; i < 3 && status == FB_OK; i++) {
      widen(&most.spin[i], motion.w[i]);
      widen(&most.rotor[i].momentum, motion.rotor_momentum[i]);
    }
    if ((k + 1) % steps == 0) {
      status = status ? status : fb_body_node_motion_eval(&twin, &tip, &state, &motion, envelope.node);
      memcpy(out + 3 * ((k + 1) / steps - 1), tip.displacement, sizeof tip.displacement);
    }
  }
  envelope = candidate ? envelope : most;
  return status;
}

/* Largest distance of a candidate from all modes and effects in short steps, by the largest displacement; FB_HUGE: its steps are
   refused. */
static double off_by(const fb_advice *candidate)
{
  static fb_real out[3 * SWINGS], reference[3 * SWINGS];
  const fb_advice all = all_of(candidate);
  double most = 0.0, size = 0.0;
  FBT_INT_EQ(swing(reference, &all), FB_OK);
  if (swing(out, candidate) != FB_OK) {
    return (double)FB_HUGE;
  }
  for (int k = 0; k < 3 * SWINGS; k += 3) {
    most = fmax(most, hypot(hypot((double)(out[k] - reference[k]), (double)(out[k + 1] - reference[k + 1])),
                            (double)(out[k + 2] - reference[k + 2])));
    size = fmax(size, hypot(hypot((double)reference[k], (double)reference[k + 1]), (double)reference[k + 2]));
  }
  moved = size;
  return most / size;
}

/* E13.10, E13.11: the advice for a craft whose pitch wheel turns meets its tolerance by simulation; the same without the
   momentum of the wheel leaves out the modes of the other plane and misses it. */
TEST(advice_on_wheels_meets_its_tolerance)
{
  static fb_real unused[3 * SWINGS];
  static const double momentum[] = {0.0, 3.0, 12.0, 25.0};
  int missed = 0;
  for (int k = 0; k < 2 * FBT_COUNT(momentum); k++) {
    const double tolerance = k % 2 ? 0.01 : 0.1;
    int along_z = 0;
    make_wheels(3, momentum[k / 2]);
    FBT_INT_EQ(swing(unused, NULL), FB_OK);
    FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, (fb_real)tolerance), FB_OK);
    for (int a = 0; a < advice.n; a++) {
      along_z += fabs((double)shape.P[3 * advice.coordinate[a] + 2]) > 1e-3;
    }
    FBT_TRUE((along_z > 0) == (k > 1));
    FBT_BELOW(off_by(&advice), tolerance);
    FBT_TRUE((double)advice.deflection > 0.7 * moved && (double)advice.deflection < 2.0 * moved);
    if (k > 1) {
      envelope.rotor[1].momentum = FB_R(0.0);
      envelope.spin[0] = envelope.spin[1] = FB_R(0.0);
      FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, (fb_real)tolerance), FB_OK);
      missed += off_by(&advice) > tolerance;
    }
  }
  FBT_TRUE(missed > 3);
}

/* E13.10: nothing but a force that stays acts on a craft whose wheels turn: what it does turns with the nutation, which
   is that of the rigid body by its eigenvalues, free and on a pin. */
TEST(nutation_drives_the_modes)
{
  static fb_analyse_work analyse;
  static fb_spectrum spectrum;
  for (int k = 0; k < 2; k++) {
    const fb_real arm[3] = {FB_R(0.4), -FB_R(0.3), FB_R(0.2)}, heavy[6] = {3, 4, 5, 0, 0, 0};
    double of_nutation, faster;
    fb_input input;
    fb_state state;
    fb_body_desc rigid;
    make_wheels(2, 0.0);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(20.0), arm, heavy), FB_OK);
    level.base = k ? FB_BASE_PINNED : FB_BASE_FREE;
    level.rotor[0].axis[1] = FB_R(2.0); /* of any length */
    envelope.n_load = 1;
    envelope.load[0].node = 1;
    envelope.load[0].force[1] = FB_R(0.2);
    envelope.rotor[2].torque = FB_R(0.0);
    for (int r = 0; r < WHEELS; r++) {
      envelope.rotor[r].momentum = FB_R(2.0) + 4 * (fb_real)r;
    }
    rigid = level;
    rigid.effects = FB_EFFECTS_RIGID;
    memset(&input, 0, sizeof input);
    FBT_INT_EQ(fb_shape_select(&other, &shape, NULL, 0), FB_OK);
    FBT_INT_EQ(fb_body_init(&twin, &body_work, &other, &rigid), FB_OK);
    FBT_INT_EQ(fb_state_init(&twin, &state), FB_OK);
    for (int r = 0; r < WHEELS; r++) {
      state.pi[r] = envelope.rotor[r].momentum;
    }
    FBT_INT_EQ(fb_body_trim(&twin, &state, &analyse, &input), FB_OK);
    FBT_INT_EQ(fb_body_spectrum_solve(&twin, &analyse, &spectrum, &state, &input), FB_OK);
    envelope.frequency = FB_R(0.0);
    of_nutation = deflection();
    envelope.frequency = spectrum.im[spectrum.n - 1];
    FBT_TRUE(envelope.frequency > FB_R(0.05));
    FBT_NEAR_REL(deflection(), of_nutation, FBT_TOL(1e-7, 1e-4));
    FBT_INT_EQ(work.turns, 1);
    envelope.frequency *= FB_R(1.3);
    faster = deflection();
    FBT_TRUE(faster > 1.001 * of_nutation);
    envelope.frequency = FB_R(0.0);
    for (int r = 0; r < WHEELS; r++) {
      envelope.rotor[r].momentum = FB_R(0.0);
    }
    FBT_TRUE(deflection() < 0.999 * of_nutation);
    FBT_INT_EQ(work.turns, 0);
  }
}

/* E13.11: a held boom with a wheel along it on its tip, under a force along z that jumps: along y it moves by the wheel
   alone, in the simulation, and in the estimate by one to three times that. A wheel that turns faster than an estimate
   can follow is refused. */
TEST(wheels_couple_the_planes_of_booms)
{
  for (int k = 0; k < 3; k++) {
    static fb_rk4_work rk4;
    const fb_real h = k == 0 ? FB_R(0.0) : k == 1 ? FB_R(0.7) : -FB_R(2.0);
    fb_input input;
    fb_state state;
    fb_node_motion tip;
    double largest = 0.0, estimate = 0.0;
    boom_under_a_force(0.5, 2, 2);
    level.n_rotor = 1;
    level.rotor[0].node = 1;
    level.rotor[0].axis[0] = FB_R(1.0);
    level.rotor[0].inertia = FB_R(0.01);
    level.rotor[0].given = k == 2;
    envelope.rotor[0].momentum = h;
    envelope.frequency = FB_HUGE;
    (void)deflection();
    for (int a = 0; a < shape.n; a++) {
      estimate += (double)(work.q[4][a] * shape.node[1].psi[3 * a + 1]);
    }
    memset(&input, 0, sizeof input);
    input.n_load = 1;
    input.load[0] = envelope.load[0];
    input.rotor[0].momentum = k == 2 ? h : FB_R(0.0);
    FBT_INT_EQ(fb_body_init(&twin, &body_work, &shape, &level), FB_OK);
    FBT_INT_EQ(fb_state_init(&twin, &state), FB_OK);
    state.pi[twin.n] = h;
    for (int step = 0; step < 2000; step++) {
      fb_motion motion;
      FBT_INT_EQ(fb_rk4_step(&twin, &state, &rk4, &input, &input, &input, FB_R(0.005)), FB_OK);
      FBT_INT_EQ(fb_body_motion_eval(&twin, &motion, &state, &input), FB_OK);
      FBT_INT_EQ(fb_body_node_motion_eval(&twin, &tip, &state, &motion, 1), FB_OK);
      largest = fmax(largest, fabs((double)tip.displacement[1]));
    }
    FBT_TRUE(k == 0 ? largest < FBT_TOL(1e-9, 1e-6) && fabs(estimate) < FBT_TOL(1e-9, 1e-6)
                    : fabs(estimate) > largest && fabs(estimate) < 3.0 * largest);
  }
  envelope.rotor[0].momentum = FB_R(60.0);
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_UNSUPPORTED);
}

/* E11.46: a step is within the limit of its integrator in the state that the extremes describe. */
TEST(advised_steps_take_wheels)
{
  static fb_real unused[3 * SWINGS];
  for (int k = 0; k < 2; k++) {
    fb_body_limit limit;
    fb_body_desc desc;
    fb_state state;
    fb_input input;
    const fb_real still[3] = {0, 0, 0};
    make_wheels(2, 40.0);
    level.rotor[0].damping = FB_R(1e-3);
    FBT_INT_EQ(swing(unused, NULL), FB_OK);
    envelope.frame = FB_R(0.0);
    FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, k ? FB_R(0.01) : FB_R(0.5)), FB_OK);
    desc = level;
    desc.effects = advice.effects;
    FBT_INT_EQ(fb_shape_select(&other, &shape, advice.coordinate, advice.n), FB_OK);
    FBT_INT_EQ(fb_body_init(&twin, &body_work, &other, &desc), FB_OK);
    FBT_INT_EQ(fb_state_init(&twin, &state), FB_OK);
    memset(&input, 0, sizeof input);
    for (int r = 0; r < WHEELS; r++) {
      state.pi[twin.n + r] = envelope.rotor[r].momentum;
    }
    FBT_INT_EQ(fb_state_from_velocity(&twin, &state, still, envelope.spin, NULL), FB_OK);
    FBT_INT_EQ(fb_body_limit_eval(&twin, &limit, &state, &input), FB_OK);
    FBT_TRUE((double)advice.dt <= 1.000001 * (double)(advice.integrator == FB_INTEGRATOR_RK4 ? limit.rk4
                                                      : advice.integrator == FB_INTEGRATOR_EXPONENTIAL
                                                          ? limit.exponential
                                                          : limit.implicit));
  }
}

/* E13.10: the spin by nutation is at some time along what loads do, at another against it: its sign does not matter.
   Friction that motors balance bends nothing. */
TEST(nutation_goes_to_and_fro)
{
  static fb_real unused[3 * SWINGS];
  double most;
  make_wheels(2, 12.0);
  FBT_INT_EQ(swing(unused, NULL), FB_OK);
  most = deflection();
  for (int i = 0; i < 3; i++) {
    envelope.spin[i] = -envelope.spin[i];
  }
  FBT_NEAR_REL(deflection(), most, FBT_TOL(1e-9, 1e-4));
  for (int r = 0; r < WHEELS; r++) {
    level.rotor[r].damping = FB_R(1e-2); /* 6 N m at 600 rad/s */
    level.rotor[r].friction = FB_R(0.5);
    level.rotor[r].friction_speed = FB_R(2.0);
  }
  FBT_NEAR_REL(deflection(), most, FBT_TOL(1e-9, 1e-4));
}

/* Interface: rotors of the envelope and of the body that are none. */
TEST(advice_on_wheels_refuses_nonsense)
{
  make_wheels(2, 1.0);
  envelope.rotor[1].momentum = (fb_real)NAN;
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_NOT_FINITE);
  envelope.rotor[1].momentum = FB_R(1.0);
  envelope.rotor[2].torque = (fb_real)INFINITY;
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_NOT_FINITE);
  envelope.rotor[2].torque = FB_R(6.0);
  level.rotor[1].static_imbalance = FB_R(1e-4);
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_UNSUPPORTED);
  level.rotor[1].static_imbalance = FB_R(0.0);
  level.rotor[2].node = 7;
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_CAPACITY);
  level.rotor[2].node = 0;
  level.rotor[2].inertia = FB_R(0.0);
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_VALUE);
  level.n_rotor = FB_MAX_ROTORS + 1;
  FBT_INT_EQ(fb_advice_solve(&advice, &work, &shape, &level, &envelope, FB_R(0.01)), FB_ERR_CAPACITY);
}

SUITE(advise_rotors, RUN(nutation_drives_the_modes), RUN(wheels_couple_the_planes_of_booms),
      RUN(advised_steps_take_wheels), RUN(nutation_goes_to_and_fro), RUN(advice_on_wheels_refuses_nonsense),
      RUN_LONG(advice_on_wheels_meets_its_tolerance))
#endif
