/* >>integrate: fb_stepper, by which all that moves is stepped alike. */
#include "integrate.h"

static fb_stepper stepper;
static fb_stepper_desc way;
static fb_system_desc pair;
static fb_system pendulum;
static fb_system_work system_work;
static fb_exact exact;
static fb_exact_work exact_work;

/* Different loads at the start, in the middle and at the end of a step. */
static void drive(fb_load *load, int instant)
{
  memset(load, 0, sizeof *load);
  load->node = 1;
  load->force[1] = (fb_real)(3.0 + 2.0 * instant);
  load->torque[2] = (fb_real)(1.0 - instant);
}

/* Ten steps of `way` from the state, `apart` with an input for each instant. */
static void ten_steps(double dt, int apart)
{
  way.dt = (fb_real)dt;
  way.n_input = apart ? 3 : 0;
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_OK);
  for (int k = 0; k < 10; k++) {
    FBT_INT_EQ(fb_stepper_step(&stepper), FB_OK);
  }
  FBT_NEAR_REL(stepper.t, 10.0 * dt, FBT_TOL(1e-15, 1e-7));
}

/* E11.3, E11.7, E11.8, E11.10: of a body, every integrator gives the bits of its own step, with an input that is held
   and with one for each instant of a step. */
TEST(steppers_of_bodies_take_the_steps_of_their_integrator)
{
  const double dt = 0.002;
  fb_input input[3];
  memset(input, 0, sizeof input);
  boom(FB_EFFECTS_FULL, FB_BASE_FREE, 2, 2, 0, 0.0);
  for (int run = 0; run < 2 * INTEGRATORS; run++) {
    const int apart = run % 2, next = apart ? 1 : 0;
    fb_state state, other;
    memset(&way, 0, sizeof way);
    way.body = &body;
    way.state = &state;
    way.input = input;
    way.integrator = (fb_integrator)(run / 2);
    way.exponential = &exponential;
    for (int i = 0; i < 3; i++) {
      input[i].n_load = 1;
      drive(&input[i].load[0], i);
    }
    fbt_seed(3);
    start(&state, 0.1, 0.3);
    other = state;
    prepare((integrator)(run / 2), dt);
    ten_steps(dt, apart);
    for (int k = 0; k < 10; k++) {
      FBT_INT_EQ(step((integrator)(run / 2), &other, input, input + next, input + 2 * next, dt), FB_OK);
    }
    FBT_TRUE(memcmp(&state, &other, sizeof state) == 0);
  }
}

/* E11.12, E11.14: the same of a system, a boom that hangs on a hinge. */
TEST(steppers_of_systems_take_the_steps_of_their_integrator)
{
  static fb_system_state state, other;
  static fb_system_input input[3];
  const fb_real dt = FB_R(0.002);
  boom(FB_EFFECTS_FULL, FB_BASE_FREE, 2, 2, 0, 0.0);
  memset(&pair, 0, sizeof pair);
  pair.n_body = 1;
  pair.joint[0].kind = FB_JOINT_REVOLUTE;
  pair.joint[0].parent = FB_GROUND;
  FBT_INT_EQ(fb_system_init(&pendulum, &system_work, &body, &pair, 1), FB_OK);
  for (int run = 0; run < 4; run++) {
    const int apart = run % 2, next = apart ? 1 : 0;
    memset(&way, 0, sizeof way);
    way.body = &body;
    way.system = &pendulum;
    way.system_state = &state;
    way.system_work = &system_work;
    way.system_input = input;
    way.integrator = run < 2 ? FB_INTEGRATOR_RK4 : FB_INTEGRATOR_SDIRK;
    for (int i = 0; i < 3; i++) {
      input[i].n_load = 1;
      drive(&input[i].load[0].load, i);
    }
    FBT_INT_EQ(fb_system_state_init(&pendulum, &body, &state, &system_work, NULL, NULL), FB_OK);
    other = state;
    ten_steps((double)dt, apart);
    for (int k = 0; k < 10; k++) {
      const fb_system_input *const middle = input + next, *const end = input + 2 * next;
      FBT_INT_EQ(run < 2 ? fb_system_rk4_step(&pendulum, &body, &other, &system_work, input, middle, end, dt)
                         : fb_system_sdirk_step(&pendulum, &body, &other, &system_work, input, end, dt, 0),
                 FB_OK);
    }
    FBT_TRUE(memcmp(&state, &other, sizeof state) == 0);
  }
}

static void slender_beam(fb_exact_state *state)
{
  fb_exact_desc desc;
  fb_section uniform;
  memset(&uniform, 0, sizeof uniform);
  uniform.mass = FB_R(1.2);
  uniform.EI_y = uniform.EI_z = FB_R(14004.0);
  memset(&desc, 0, sizeof desc);
  desc.length = FB_R(10.0);
  desc.n_element = 4;
  desc.n_station = 1;
  FBT_INT_EQ(fb_exact_station_init(&desc.station[0], &uniform), FB_OK);
  FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_OK);
  FBT_INT_EQ(fb_exact_state_init(&exact, state, &exact_work, NULL), FB_OK);
}

/* E11.20: the same of an exact beam, whose step takes the input of its middle. */
TEST(steppers_of_exact_beams_take_its_steps)
{
  static fb_exact_state state, other;
  static fb_exact_input input[3];
  const fb_real dt = FB_R(0.01);
  for (int apart = 0; apart < 2; apart++) {
    memset(&way, 0, sizeof way);
    way.exact = &exact;
    way.exact_state = &state;
    way.exact_work = &exact_work;
    way.exact_input = input;
    way.integrator = apart ? FB_INTEGRATOR_MIDPOINT : FB_INTEGRATOR_RK4;
    for (int i = 0; i < 3; i++) {
      input[i].n_load = 1;
      drive(&input[i].load[0], i);
    }
    slender_beam(&state);
    other = state;
    ten_steps((double)dt, apart);
    for (int k = 0; k < 10; k++) {
      FBT_INT_EQ(fb_exact_step(&exact, &other, &exact_work, &input[apart], dt), FB_OK);
    }
    FBT_TRUE(memcmp(&state, &other, sizeof state) == 0);
  }
}

/* E11.22: a stepper's clock adds up without loss, over 1e6 steps of 0.1 ms, too. */
TEST(clocks_of_steppers_lose_nothing)
{
  fb_state state;
  const double dt = (double)FB_R(1e-4);
  const int steps = FBT_SHORT ? 10000 : 1000000;
  boom(FB_EFFECTS_LINEAR, FB_BASE_FREE, 0, 0, 0, 0.0);
  start(&state, 0.0, 0.0);
  memset(&way, 0, sizeof way);
  way.body = &body;
  way.state = &state;
  way.dt = (fb_real)dt;
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_OK);
  for (int k = 0; k < steps; k++) {
    FBT_INT_EQ(fb_stepper_step(&stepper), FB_OK);
  }
  FBT_NEAR_REL(stepper.t, dt * steps, FBT_TOL(3e-16, 1.2e-7));
}

/* Interface: a description that is not one is refused; a step that is refused leaves state and clock. */
TEST(steppers_refuse_what_they_cannot_step)
{
  static fb_system_state system_state;
  static fb_exact_state exact_state;
  fb_state state, before;
  memset(&pair, 0, sizeof pair);
  pair.n_body = 1;
  pair.joint[0].kind = FB_JOINT_REVOLUTE;
  pair.joint[0].parent = FB_GROUND;
  slender_beam(&exact_state);
  boom(FB_EFFECTS_FULL, FB_BASE_FREE, 2, 2, 0, 0.0);
  fbt_seed(3);
  start(&state, 0.1, 0.3);
  prepare(EXPONENTIAL, 0.002);
  FBT_INT_EQ(fb_system_init(&pendulum, &system_work, &body, &pair, 1), FB_OK);
  FBT_INT_EQ(fb_system_state_init(&pendulum, &body, &system_state, &system_work, NULL, NULL), FB_OK);
  memset(&way, 0, sizeof way);
  FBT_INT_EQ(fb_stepper_init(&stepper, NULL), FB_ERR_NULL);
  FBT_INT_EQ(fb_stepper_init(NULL, &way), FB_ERR_NULL);
  FBT_INT_EQ(fb_stepper_step(NULL), FB_ERR_NULL);
  way.dt = FB_R(0.002);
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_ERR_NULL); /* nothing */
  way.body = &body;
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_ERR_NULL); /* no state */
  way.state = &state;
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_OK);
  before = state;
  memset(state.quat, 0, sizeof state.quat); /* not from fb_state_init */
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_ERR_VALUE);
  state = before;
  way.integrator = FB_INTEGRATOR_EXPONENTIAL;
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_ERR_NULL); /* not prepared */
  way.exponential = &exponential;
  way.dt = FB_R(0.003); /* for another step */
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_ERR_VALUE);
  way.integrator = (fb_integrator)(FB_INTEGRATOR_EXPONENTIAL + 1);
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_ERR_VALUE);
  way.integrator = FB_INTEGRATOR_SDIRK;
  for (int k = 0; k < 5; k++) {
    static const fb_real dt[5] = {0, -1, (fb_real)NAN, (fb_real)INFINITY, FB_R(0.002)};
    static const int iterations[5] = {0, 0, 0, 0, 51};
    way.dt = dt[k];
    way.iterations = iterations[k];
    FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_ERR_VALUE);
  }
  way.iterations = 50;
  for (int k = -1; k < 5; k++) {
    way.n_input = k;
    FBT_INT_EQ(fb_stepper_init(&stepper, &way), k == 0 || k == 1 || k == 3 ? FB_OK : FB_ERR_VALUE);
  }
  way.n_input = 3; /* three times nothing */
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_OK);
  FBT_INT_EQ(fb_stepper_step(&stepper), FB_OK);

  /* a step that is too long */
  way.integrator = FB_INTEGRATOR_RK4;
  way.dt = FB_R(10.0);
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_OK);
  before = state;
  FBT_INT_EQ(fb_stepper_step(&stepper), FB_ERR_STEP);
  FBT_TRUE(memcmp(&state, &before, sizeof state) == 0 && !(stepper.t > FB_R(0.0)));

  /* two at once; integrators that systems and exact beams have not */
  way.system = &pendulum;
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_ERR_VALUE);
  way.state = NULL;
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_ERR_VALUE); /* something of a body is left */
  way.exponential = NULL;
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_ERR_NULL);
  way.system_state = &system_state;
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_ERR_NULL);
  way.system_work = &system_work;
  for (int k = 0; k < INTEGRATORS; k++) {
    way.integrator = (fb_integrator)k;
    FBT_INT_EQ(fb_stepper_init(&stepper, &way),
               k == FB_INTEGRATOR_RK4 || k == FB_INTEGRATOR_SDIRK ? FB_OK : FB_ERR_UNSUPPORTED);
  }
  way.body = NULL;
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_ERR_NULL);
  way.exact = &exact;
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_ERR_VALUE);
  way.system = NULL;
  way.system_state = NULL;
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_ERR_VALUE);
  way.system_work = NULL;
  FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_ERR_NULL);
  way.exact_state = &exact_state;
  way.exact_work = &exact_work;
  for (int k = 0; k < INTEGRATORS; k++) {
    way.integrator = (fb_integrator)k;
    FBT_INT_EQ(fb_stepper_init(&stepper, &way),
               k == FB_INTEGRATOR_RK4 || k == FB_INTEGRATOR_MIDPOINT ? FB_OK : FB_ERR_UNSUPPORTED);
  }

  /* a body with a single thing of a system or of an exact beam */
  for (int k = 0; k < 7; k++) {
    static fb_system_input system_input;
    static fb_exact_input exact_input;
    memset(&way, 0, sizeof way);
    way.dt = FB_R(0.002);
    way.body = &body;
    way.state = &state;
    FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_OK);
    way.system = k == 0 ? &pendulum : NULL;
    way.system_state = k == 1 ? &system_state : NULL;
    way.system_work = k == 2 ? &system_work : NULL;
    way.system_input = k == 3 ? &system_input : NULL;
    way.exact_state = k == 4 ? &exact_state : NULL;
    way.exact_work = k == 5 ? &exact_work : NULL;
    way.exact_input = k == 6 ? &exact_input : NULL;
    FBT_INT_EQ(fb_stepper_init(&stepper, &way), FB_ERR_VALUE);
  }
}

SUITE(integrate_stepper, RUN(steppers_of_bodies_take_the_steps_of_their_integrator),
      RUN(steppers_of_systems_take_the_steps_of_their_integrator), RUN(steppers_of_exact_beams_take_its_steps),
      RUN(clocks_of_steppers_lose_nothing), RUN(steppers_refuse_what_they_cannot_step))
