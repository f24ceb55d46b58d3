/* stepper.h - one body, by whichever integrator. Include flexbeam.h first. */
#ifndef STEPPER_H
#define STEPPER_H

/* Their names, by fb_integrator: of fb_NAME_step. */
static const char *const stepper_name[] = {"rk4", "midpoint", "sdirk", "exponential"};
typedef char stepper_names_are_whole[sizeof stepper_name / sizeof stepper_name[0] == FB_INTEGRATOR_COUNT ? 1 : -1];

typedef struct stepper {
  fb_integrator integrator;
  fb_exponential exponential;
  fb_rk4_work rk4;
  fb_implicit_work implicit;
  fb_exponential_work scratch;
} stepper;

/* For steps of dt. */
static inline fb_status stepper_init(stepper *s, fb_body_work *work, const fb_body *body, fb_integrator integrator,
                                     double dt)
{
  s->integrator = integrator;
  return integrator == FB_INTEGRATOR_EXPONENTIAL ? fb_exponential_init(&s->exponential, work, body, (fb_real)dt)
                                                 : FB_OK;
}

/* at: the inputs at the start, the middle and the end. */
static inline fb_status stepper_step(stepper *s, const fb_body *body, fb_state *state, const fb_input *at, fb_real dt)
{
  switch (s->integrator) {
  case FB_INTEGRATOR_RK4:
    return fb_rk4_step(body, state, &s->rk4, at, at + 1, at + 2, dt);
  case FB_INTEGRATOR_MIDPOINT:
    return fb_midpoint_step(body, state, &s->implicit, at + 1, dt, 0);
  case FB_INTEGRATOR_SDIRK:
    return fb_sdirk_step(body, state, &s->implicit, at, at + 2, dt, 0);
  case FB_INTEGRATOR_EXPONENTIAL:
    return fb_exponential_step(body, &s->exponential, state, &s->scratch, at, at + 1, at + 2);
  case FB_INTEGRATOR_COUNT:
    break;
  }
  return FB_ERR_UNSUPPORTED;
}
#endif
