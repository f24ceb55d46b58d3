/* scheme.h - a step by any of the schemes. */
#ifndef FBB_SCHEME_H
#define FBB_SCHEME_H

#include "../flexbeam.h"

/* Inputs at the start, the middle and the end of the step; exponential: made for the body and dt, or NULL for others. */
static inline fb_status fbb_step(const fb_body *body, const fb_exponential *exponential, fb_state *state,
                                 fb_scheme scheme, const fb_input *input, fb_real dt)
{
  static fb_rk4_work rk4;
  static fb_implicit_work implicit;
  static fb_exponential_work scratch;
  switch (scheme) {
  case FB_SCHEME_RK4:
    return fb_rk4_step(body, state, &rk4, input, input + 1, input + 2, dt);
  case FB_SCHEME_MIDPOINT:
    return fb_midpoint_step(body, state, &implicit, input + 1, dt, 0);
  case FB_SCHEME_SDIRK:
    return fb_sdirk_step(body, state, &implicit, input, input + 2, dt, 0);
  default:
    return fb_exponential_step(body, exponential, state, &scratch, input, input + 1, input + 2);
  }
}

#endif
