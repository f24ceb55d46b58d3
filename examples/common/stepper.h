/* stepper.h - a stepper of one body with inputs for each instant of a step, the exponential integrator prepared.
   Include flexbeam.h first. */
#ifndef STEPPER_H
#define STEPPER_H

/* Names of the integrators, by fb_integrator: of fb_NAME_step. */
static const char *const stepper_name[] = {"rk4", "midpoint", "sdirk", "exponential"};
typedef char stepper_names_are_whole[sizeof stepper_name / sizeof stepper_name[0] == FB_INTEGRATOR_COUNT ? 1 : -1];

/* input: at the start, the middle and the end of a step; exponential: room for that integrator. */
static inline fb_status body_stepper(fb_stepper *stepper, fb_exponential *exponential, fb_body_work *work,
                                     const fb_body *body, fb_state *state, const fb_input *input,
                                     fb_integrator integrator, double dt)
{
  const fb_stepper_desc way = {.body = body,
                               .state = state,
                               .input = input,
                               .n_input = 3,
                               .integrator = integrator,
                               .exponential = exponential,
                               .dt = (fb_real)dt};
  const fb_status status =
      integrator == FB_INTEGRATOR_EXPONENTIAL ? fb_exponential_init(exponential, work, body, (fb_real)dt) : FB_OK;
  return status ? status : fb_stepper_init(stepper, &way);
}
#endif
