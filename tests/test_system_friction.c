/* >>system: friction and stops of joints. */
#include "system.h"

static fb_system_state kept, rate;
static fb_system_analyse_work analyse_work;
static fb_spectrum spectrum;

/* A body of 2 kg and 0.5 kg m^2 about z that turns about z or slides along it. */
static fb_joint_desc *one_axis(int slides)
{
  fresh();
  rigid(&model[0], 2.0, 0, 0, 0, 0.3, 0.4, 0.5);
  hang(0, 0, slides ? FB_JOINT_PRISMATIC : FB_JOINT_REVOLUTE, FB_GROUND, 0);
  return &desc.joint[0];
}

static void set_off(int form, double value, double speed)
{
  start[0].value[0] = (fb_real)value;
  start[0].speed[0] = (fb_real)speed;
  init(form);
  FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
}

static void advance(double dt)
{
  FBT_INT_EQ(implicit ? fb_system_sdirk_step(&mechanism, model, &state, &work, &input, &input, (fb_real)dt, implicit)
                      : fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, (fb_real)dt),
             FB_OK);
}

/* Value and speed of the joint as they are. */
static void look(double *value, double *speed)
{
  motion_of(&motion, &state);
  *value = (double)motion.joint[0].value[0];
  *speed = (double)motion.joint[0].speed[0];
}

/* E9.28: u' = -(F/J) u/sqrt(u^2 + u_0^2) gives sqrt(u^2 + u_0^2) - u_0 asinh(u_0/u) + F t/J = const; by rk4 and SDIRK, joint
   of the tree and of a loop. Under a load a joint creeps at the speed at which friction balances it. */
TEST(friction_stops_a_wheel_as_in_closed_form)
{
  const double F = 1.5, J = 0.5, u0 = 0.2, first = 3.0, dt = 1e-3;
  const double asinh0 = log(u0 / first + sqrt(u0 * u0 / (first * first) + 1.0)); /* C99 has asinh, C++98 has not */
  double worst = 0.0;
  for (int run = 0; run < 4; run++) {
    double value, speed;
    fb_joint_desc *j = one_axis(0);
    j->friction[0] = (fb_real)F;
    j->friction_speed[0] = (fb_real)u0;
    implicit = run % 2 ? 4 : 0;
    set_off(run < 2 ? (int)FB_METHOD_RECURSIVE : AS_LOOPS, 0.0, first);
    for (int step = 0; step < 1050; step++) {
      advance(dt);
    }
    look(&value, &speed);
    FBT_BELOW(speed, 0.3 * first);
    {
      const double lost = sqrt(first * first + u0 * u0) - u0 * asinh0 - F / J * 1.05;
      const double now = sqrt(speed * speed + u0 * u0) - u0 * log(u0 / speed + sqrt(u0 * u0 / (speed * speed) + 1.0));
      FBT_NEAR_ABS(now, lost, run % 2 ? FBT_TOL(1e-5, 1e-3) : FBT_TOL(1e-9, 1e-3));
      worst = run % 2 ? worst : fmax(worst, fabs(now - lost));
    }
    input.drive[joint_at[0]].torque[0] = FB_R(0.6); /* 0.4 F: u = u_0 0.4/sqrt(1 - 0.16) */
    for (int step = 0; step < 6000; step++) {
      advance(dt);
    }
    look(&value, &speed);
    FBT_NEAR_REL(speed, u0 * 0.4 / sqrt(0.84), FBT_TOL(1e-9, 1e-3));
  }
  fbt_figure("wheel slowed by regularized Coulomb friction, rk4", "closed form", worst);
  implicit = 0;
}

/* E9.29: m v dv/(1 + c v) = -k d dd keeps c v - ln(1 + c v) from where the stop is met to where it is left, and the
   greatest depth is D^2 = 2 m/(k c^2) (c v_0 - ln(1 + c v_0)); at both stops. */
TEST(stops_return_an_impact_as_in_closed_form)
{
  const double m = 2.0, k = 800.0, c = 0.4, v0 = 1.5, dt = 2e-4;
  const double kept_there = c * v0 - log(1.0 + c * v0), depth = sqrt(2.0 * m / (k * c * c) * kept_there);
  double worst = 0.0;
  for (int run = 0; run < 8; run++) {
    const double side = run % 2 ? -1.0 : 1.0;
    double value, speed, most = 0.0;
    fb_joint_desc *j = one_axis(1);
    j->stop[0][0] = FB_R(-0.1);
    j->stop[0][1] = FB_R(0.3);
    j->stop_stiffness[0] = (fb_real)k;
    j->stop_loss[0] = (fb_real)c;
    implicit = run / 2 % 2 ? 6 : 0;
    set_off(run < 4 ? (int)FB_METHOD_RECURSIVE : AS_LOOPS, run % 2 ? -0.1 : 0.3, side * v0);
    for (int step = 0; step < 1000; step++) {
      advance(dt);
      look(&value, &speed);
      most = fmax(most, side > 0.0 ? value - 0.3 : -0.1 - value);
    }
    FBT_TRUE(value > -0.1 && value < 0.3); /* off again */
    FBT_NEAR_REL(most, depth, FBT_TOL(1e-5, 1e-3));
    speed *= -side;
    FBT_NEAR_ABS(-c * speed - log(1.0 - c * speed), kept_there, FBT_TOL(2e-6, 1e-3));
    worst = fmax(worst, fabs(-c * speed - log(1.0 - c * speed) - kept_there));
  }
  fbt_figure("impact on a stop with loss: its first integral", "closed form", worst);
  implicit = 0;
}

/* E9.29, E11.13: the iteration of a step has the whole tangent of a stop, the damping of its loss k c |d|, too: each
   correction squares the error of a stage, inwards and outwards, at both stops. */
TEST(steps_in_a_stop_converge_quadratically)
{
  for (int run = 0; run < 4; run++) {
    const double side = run % 2 ? -1.0 : 1.0, inwards = run / 2 ? -1.0 : 1.0;
    double at[5][2], error[4];
    fb_joint_desc *j = one_axis(1);
    j->stop[0][0] = FB_R(-0.1);
    j->stop[0][1] = FB_R(0.1);
    j->stop_stiffness[0] = FB_R(800.0); /* period 0.3 s */
    j->stop_loss[0] = FB_R(0.4);
    for (int k = 0; k < 5; k++) {
      implicit = k == 4 ? 12 : k + 1;
      set_off(FB_METHOD_RECURSIVE, side * 0.2, side * inwards * 1.5);
      advance(0.05);
      look(&at[k][0], &at[k][1]);
    }
    for (int k = 0; k < 4; k++) {
      error[k] = fabs(at[k][1] - at[4][1]);
    }
    FBT_BELOW(1e-4, error[0]);
    for (int k = 0; k < 3; k++) {
      FBT_BELOW(error[k + 1], 0.05 * error[k] * error[k] + FBT_TOL(1e-14, 1e-6)); /* [s/m] 0.05, [m/s] */
    }
  }
  implicit = 0;
}

/* Friction and stops on all axes that have coordinates, most of them beyond a stop. */
static void rubbing_tree(void)
{
  tree(FB_EFFECTS_FULL, 0);
  for (int k = 1; k < desc.n_body; k++) {
    fb_joint_desc *j = &desc.joint[k];
    for (int i = 0; i < 3 && j->kind != FB_JOINT_SPHERICAL; i++) {
      j->friction[i] = (fb_real)(0.5 + 0.4 * fbt_random());
      j->friction_speed[i] = FB_R(0.3);
      j->stop_stiffness[i] = (fb_real)(5.0 + fbt_random());
      j->stop_loss[i] = FB_R(0.2);
      j->stop[i][0] = i + k % 2 ? FB_R(-0.02) : FB_R(0.5);
      j->stop[i][1] = i + k % 2 ? FB_R(0.01) : FB_R(0.6);
    }
  }
}

/* E9.28, E9.29, E11.5: the energy falls by F u^2/sqrt(u^2 + u_0^2) and k c |d| u^2 of every axis and by nothing else,
   by either method and with the joints as loops, which agree. */
TEST(friction_and_stops_take_the_energy_that_they_say)
{
  static const double weight[5] = {1.0 / 12, -2.0 / 3, 0, 2.0 / 3, -1.0 / 12};
  static fb_system_motion first;
  const double h = FBT_TOL(1e-4, 1e-2);
  for (int form = 0; form < FORMS; form++) {
    double power = 0.0, slope = 0.0;
    rubbing_tree();
    init(form);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    motion_of(&motion, &state);
    first = form == 0 ? motion : first;
    FBT_BELOW(motion_difference(&motion, &first), FBT_TOL(1e-11, 1e-3));
    for (int k = 1; k < desc.n_body; k++) {
      const fb_joint_desc *j = joint_of(k);
      for (int i = 0; i < axes_of((int)j->kind)->count && j->kind != FB_JOINT_SPHERICAL; i++) {
        const double u = (double)motion.joint[k].speed[i], x = (double)motion.joint[k].value[i];
        const double low = x - (double)j->stop[i][0], high = x - (double)j->stop[i][1];
        const double d = low < 0.0 ? low : fmax(high, 0.0);
        power -= (double)j->friction[i] * u * u / sqrt(u * u + 0.09);
        power -= (double)j->stop_stiffness[i] * 0.2 * fabs(d) * u * u;
      }
    }
    FBT_NEAR_ABS(motion.power, 0.0, FBT_TOL(1e-12, 1e-5));
    if (form != AS_LOOPS) { /* of loops the rates do not hold the energy to rounding */
      memset(&rate, 0, sizeof rate);
      FBT_INT_EQ(fb_system_rates_eval(&mechanism, model, &work, &rate, &state, &input), FB_OK);
      for (int side = -2; side <= 2; side++) {
        moved(&kept, &state, &rate, side * h);
        slope += weight[side + 2] / h * energy_of(&kept);
      }
      FBT_NEAR_REL(slope, power, FBT_TOL(1e-8, 2e-2));
    }
    FBT_TRUE(power < -1.0);
  }
}

/* E11.43: rk4 is stable up to the bound of a stop, k (1 + c u)^2/m, and of friction, F/(m u_0), and refuses beyond; steps at
   0.97 of it stay bounded. Of a joint of the tree SDIRK takes longer steps. */
TEST(stops_bound_the_step)
{
  const double radius = 2.785, k = 800.0, c = 0.4, m = 2.0, F = 3.0, u0 = 0.02;
  fb_system_limit limit;
  for (int run = 0; run < 12; run++) {
    const int rubs = run % 3 == 2, hits = run % 3 == 1, form = run < 6 ? (int)FB_METHOD_RECURSIVE : AS_LOOPS;
    const double speed = hits ? 2.5 : 0.0;
    const double bound = (rubs ? F / (m * u0) : sqrt(k / m) * (1.0 + c * speed));
    fb_joint_desc *j = one_axis(1);
    if (rubs) {
      j->friction[0] = (fb_real)F;
      j->friction_speed[0] = (fb_real)u0;
    } else {
      j->stop[0][1] = FB_R(0.3);
      j->stop_stiffness[0] = (fb_real)k;
      j->stop_loss[0] = (fb_real)c;
    }
    if (run / 3 % 2) { /* steps up to the limit */
      set_off(form, 0.1, rubs ? 0.1 : 1.0);
      FBT_INT_EQ(fb_system_limit_eval(&mechanism, model, &work, &limit, &state, &input), FB_OK);
      for (int step = 0; step < 500; step++) {
        double value, v;
        advance(0.9 * (double)limit.rk4);
        look(&value, &v);
        FBT_BELOW(fabs(v), rubs ? 0.1001 : 1.05); /* no step beyond its bound adds energy */
      }
      continue;
    }
    set_off(form, 0.1, speed);
    FBT_INT_EQ(fb_system_limit_eval(&mechanism, model, &work, &limit, &state, &input), FB_OK);
    FBT_BELOW((double)limit.rk4, 1.001 * radius / bound);
    FBT_BELOW(0.93 * radius / bound, (double)limit.rk4); /* the power method's 5 % */
    FBT_TRUE(form != AS_LOOPS ? limit.sdirk > FB_R(100.0) : limit.sdirk * (fb_real)bound <= FB_R(1.001));
    kept = state;
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, FB_R(1.01) * limit.rk4),
               FB_ERR_STEP);
    FBT_TRUE(memcmp(&kept, &state, sizeof state) == 0);
  }
}

#if FB_WITH_ROTORS
/* E11.43 counts the present speeds of the joints, whatever other bounds are solved for: of a body that carries a rotor
   as of one without. */
TEST(stops_bound_the_step_beside_rotors)
{
  fb_system_limit at[2];
  for (int k = 0; k < 2; k++) {
    fresh();
    if (k) {
      body_desc.n_rotor = 1;
      body_desc.rotor[0].axis[2] = FB_R(1.0);
      body_desc.rotor[0].inertia = FB_R(2e-6);
    }
    rigid(&model[0], 10.0, 0, 0, 0, 2.0, 2.02, 2.0);
    hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
    desc.joint[0].stop[0][0] = -FB_R(1.0);
    desc.joint[0].stop[0][1] = FB_R(1.0);
    desc.joint[0].stop_stiffness[0] = FB_R(1e3);
    desc.joint[0].stop_loss[0] = FB_R(5.0);
    start[0].value[0] = FB_R(0.999);
    start[0].speed[0] = FB_R(10.0);
    init(FB_METHOD_RECURSIVE);
    FBT_INT_EQ(fb_system_state_init(&mechanism, model, &state, &work, start, &input), FB_OK);
    FBT_INT_EQ(fb_system_limit_eval(&mechanism, model, &work, &at[k], &state, &input), FB_OK);
    FBT_NEAR_REL(at[k].rk4, at[0].rk4, 0.02);
  }
}
#define BESIDE_ROTORS , RUN(stops_bound_the_step_beside_rotors)
#else
#define BESIDE_ROTORS
#endif

/* E9.28, E9.29: SDIRK with steps far beyond friction's time constant and the stop's period: a wheel comes to rest, one
   that a motor pushes rests on its stop where the spring holds it. */
TEST(implicit_steps_rest_in_friction_and_on_stops)
{
  double value, speed;
  fb_joint_desc *j = one_axis(0);
  j->friction[0] = FB_R(1.5);
  j->friction_speed[0] = FB_R(1e-4); /* 1/30000 s */
  implicit = 12;
  set_off(FB_METHOD_RECURSIVE, 0.0, 3.0);
  for (int step = 0; step < 200; step++) {
    advance(0.01);
  }
  look(&value, &speed);
  FBT_BELOW(fabs(speed), 1e-6);
  FBT_NEAR_ABS(value, 3.0 * 3.0 * 0.5 / (2.0 * 1.5), 2e-2);

  j = one_axis(0);
  j->stop[0][1] = FB_R(0.3);
  j->stop_stiffness[0] = FB_R(2e6); /* period 3 ms */
  j->stop_loss[0] = FB_R(1.0);
  input.drive[0].torque[0] = FB_R(2.0);
  set_off(FB_METHOD_RECURSIVE, 0.0, 0.0);
  for (int step = 0; step < 400; step++) {
    advance(0.01);
  }
  look(&value, &speed);
  FBT_BELOW(fabs(speed), 1e-5);
  FBT_NEAR_REL(value - 0.3, 2.0 / 2e6, FBT_TOL(1e-3, 0.1)); /* single: 0.3 ends at 3e-8 */
  implicit = 0;
}

/* E12.9: linear models about rest hold friction as the damper F/u_0 and a stop that a motor leans on as its spring with the
   damper k c d, d where the trim finds it. */
TEST(linear_models_hold_friction_and_stops)
{
  const double J = 0.5, k = 800.0, c = 0.4, F = 1.5, u0 = 0.5, load = 6.0;
  for (int run = 0; run < 4; run++) {
    const double damping = run % 2 ? k * c * load / k : F / u0;
    double worst = 0.0;
    fb_joint_desc *j = one_axis(0);
    if (run % 2) {
      j->stop[0][1] = FB_R(0.3);
      j->stop_stiffness[0] = (fb_real)k;
      j->stop_loss[0] = (fb_real)c;
      input.drive[0].torque[0] = (fb_real)load;
    } else {
      j->stiffness[0] = (fb_real)k;
      j->friction[0] = (fb_real)F;
      j->friction_speed[0] = (fb_real)u0;
    }
    set_off(run < 2 ? FB_METHOD_RECURSIVE : FB_METHOD_DENSE, run % 2 ? 0.31 : 0.0, 0.0);
    FBT_INT_EQ(fb_system_trim(&mechanism, model, &state, &analyse_work, &input), FB_OK);
    FBT_NEAR_ABS(state.link[0].x[0], run % 2 ? 0.3 + load / k : 0.0, FBT_TOL(1e-9, 1e-4));
    FBT_INT_EQ(fb_system_spectrum_solve(&mechanism, model, &analyse_work, &spectrum, &state, &input), FB_OK);
    FBT_INT_EQ(spectrum.n, 1);
    worst = fmax(worst, fabs((double)spectrum.re[0] / (-damping / (2.0 * J)) - 1.0));
    worst = fmax(worst, fabs((double)spectrum.im[0] / sqrt(k / J - pow(damping / (2.0 * J), 2.0)) - 1.0));
    FBT_BELOW(worst, FBT_TOL(1e-6, 1e-2));
  }
  for (int method = 0; method < 2;
       method++) { /* a wheel that turns steadily: the tangent F u_0^2/(u^2 + u_0^2)^(3/2) */
    static fb_linear linear;
    const double u = 0.7;
    fb_joint_desc *j = one_axis(0);
    j->friction[0] = (fb_real)F;
    j->friction_speed[0] = (fb_real)u0;
    input.drive[0].torque[0] = (fb_real)(F * u / sqrt(u * u + u0 * u0));
    set_off(method, 0.2, u);
    FBT_INT_EQ(fb_system_linearize(&mechanism, model, &analyse_work, &linear, &state, &input, NULL), FB_OK);
    FBT_NEAR_REL(linear.A[3], -F * u0 * u0 / pow(u * u + u0 * u0, 1.5) / J, FBT_TOL(1e-6, 1e-2));
  }
}

/* Interface: joints refuse friction and stops that mean nothing; check and word see each field. */
TEST(friction_and_stops_are_checked)
{
  const fb_real nan_now = (fb_real)NAN;
  unsigned word;
  for (int run = 0; run < 9; run++) {
    fb_joint_desc *j = one_axis(0);
    fb_status want = FB_ERR_VALUE;
    j->friction[0] = FB_R(1.0);
    j->friction_speed[0] = FB_R(0.1);
    j->stop_stiffness[0] = FB_R(10.0);
    j->stop[0][1] = FB_R(0.5);
    switch (run) {
    case 0:
      j->friction[0] = FB_R(-1.0);
      break;
    case 1:
      j->friction_speed[0] = FB_R(0.0);
      break;
    case 2:
      j->stop[0][0] = FB_R(0.5);
      break; /* none between */
    case 3:
      j->stop_stiffness[0] = FB_R(-1.0);
      break;
    case 4:
      j->stop_loss[0] = FB_R(-1.0);
      break;
    case 5:
      j->friction[0] = nan_now, want = FB_ERR_NOT_FINITE;
      break;
    case 6:
      j->kind = FB_JOINT_SPHERICAL;
      break;
    case 7:
      j->stop[0][1] = FB_R(4.0), desc.loop[0] = *j, desc.n_loop = 1; /* of a loop, beyond half a turn */
      desc.loop[0].child = 0;
      memset(j, 0, sizeof *j);
      break;
    default:
      j->stop[0][1] = FB_R(4.0), want = FB_OK;
      break;
    }
    FBT_INT_EQ(fb_system_init(&mechanism, &work, model, &desc, fbt_models(&desc)), want);
  }
  word = fb_system_crc(&mechanism, model, FB_MAX_BODIES);
  for (int run = 0; run < 5; run++) {
    fb_joint *const j = &mechanism.joint[0];
    fb_real *const field[5] = {j->friction, j->friction_speed, j->stop[0], j->stop_stiffness, j->stop_loss};
    const fb_real was = *field[run];
    *field[run] = was + FB_R(0.5);
    FBT_TRUE(fb_system_crc(&mechanism, model, FB_MAX_BODIES) != word);
    *field[run] = nan_now;
    FBT_INT_EQ(fb_system_check(&mechanism, model, FB_MAX_BODIES), FB_ERR_VALUE);
    *field[run] = was;
  }
  FBT_INT_EQ(fb_system_check(&mechanism, model, FB_MAX_BODIES), FB_OK);
}

SUITE(system_friction, RUN_LONG(friction_stops_a_wheel_as_in_closed_form),
      RUN(stops_return_an_impact_as_in_closed_form), RUN(steps_in_a_stop_converge_quadratically),
      RUN(friction_and_stops_take_the_energy_that_they_say), RUN(stops_bound_the_step),
      RUN(implicit_steps_rest_in_friction_and_on_stops), RUN(linear_models_hold_friction_and_stops),
      RUN(friction_and_stops_are_checked) BESIDE_ROTORS)
