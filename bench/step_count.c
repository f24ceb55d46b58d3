/* step_count - steps one body, for a counter of instructions (tests/checks/instructions.sh).
   usage: step_count Y Z AXIAL EFFECTS[/POINTS] STEPS [INTEGRATOR [decayed | held]]
   Y, Z, AXIAL: modes of each kind; EFFECTS: mask of FB_EFFECT_...; POINTS: along the boom, for large deflection (287;
   default: the library's); INTEGRATOR: fb_rk4_step (default), fb_midpoint_step,
   fb_sdirk_step, fb_exponential_step; decayed: the elastic motion is about to vanish; held: so is the hub, else it
   flies. */
#include "sets.h"
#include "../examples/common/stepper.h"

static fb_body body;
static fb_body_work body_work;
static fb_exponential exponential;

static fb_status step(fb_integrator integrator, fb_state *state, fb_real dt)
{
  static fb_rk4_work rk4;
  static fb_implicit_work implicit;
  static fb_exponential_work work;
  switch (integrator) {
  case FB_INTEGRATOR_RK4:
    return fb_rk4_step(&body, state, &rk4, NULL, NULL, NULL, dt);
  case FB_INTEGRATOR_MIDPOINT:
    return fb_midpoint_step(&body, state, &implicit, NULL, dt, 0);
  case FB_INTEGRATOR_SDIRK:
    return fb_sdirk_step(&body, state, &implicit, NULL, NULL, dt, 0);
  case FB_INTEGRATOR_EXPONENTIAL:
    return fb_exponential_step(&body, &exponential, state, &work, NULL, NULL, NULL);
  case FB_INTEGRATOR_COUNT:
    break;
  }
  return FB_ERR_UNSUPPORTED;
}

/* Number of fb_NAME_step; FB_INTEGRATOR_COUNT: none. */
static int integrator_of(const char *function)
{
  char name[64];
  int k = -1;
  do {
    k++;
    snprintf(name, sizeof name, "fb_%s_step", k < FB_INTEGRATOR_COUNT ? stepper_name[k] : "");
  } while (k < FB_INTEGRATOR_COUNT && strcmp(function, name) != 0);
  return k;
}

int main(int argc, char **argv)
{
  fb_state state;
  const int decayed = argc == 8 && strcmp(argv[7], "decayed") == 0, held = argc == 8 && strcmp(argv[7], "held") == 0;
  const int integrator = integrator_of(argc > 6 ? argv[6] : "fb_rk4_step");
  const char *points;
  fb_real dt;
  if (argc < 6 || argc > 8 || (argc == 8 && !decayed && !held) || integrator == FB_INTEGRATOR_COUNT) {
    fprintf(stderr, "usage: step_count Y Z AXIAL EFFECTS[/POINTS] STEPS [INTEGRATOR [decayed | held]]\n");
    return 2;
  }
  points = strchr(argv[4], '/');
  fbb_check(boom_craft_points(&body, held ? FB_BASE_PRESCRIBED : FB_BASE_FREE, atoi(argv[1]), atoi(argv[2]),
                              atoi(argv[3]), (unsigned)atoi(argv[4]), FB_R(0.5), points ? atoi(points + 1) : 0),
            "body");
  fbb_state(&state, &body, 0, decayed || held ? FB_R(0.0) : FB_R(1.0), decayed ? (fb_real)1e-133 : FB_R(0.01));
  dt = FB_R(0.5) * fb_rk4_limit(&body, FB_R(2.0), FB_R(10.0));
  dt = dt < FB_R(0.01) ? dt : FB_R(0.01);
  if (integrator == FB_INTEGRATOR_EXPONENTIAL) {
    fbb_check(fb_exponential_init(&exponential, &body_work, &body, dt), "exponential scheme");
  }
  for (int k = atoi(argv[5]); k > 0; k--) {
    fbb_check(step((fb_integrator)integrator, &state, dt), "step");
  }
  printf("n = %d, q[0] = %g, n_lambda = %d, n_S = %d\n", body.n, (double)state.q[0], body.n_lambda, body.n_S);
  return 0;
}
