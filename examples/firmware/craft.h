/* craft - the satellite's body as the program wants it, in one of two ways with the same equations:
     by the library and a model in ROM,  reduce examples/satellite.txt --out satellite_rom.h
     -DGENERATED=1: by its own code,     reduce examples/satellite.txt --code --out satellite_code.h
   The second links no step of the library; flexbeam.h gives it quaternions and texts. */
#ifndef CRAFT_H
#define CRAFT_H
#ifndef GENERATED
#define GENERATED 0
#endif
#define CRAFT_MODES 6

/* What a controller knows of each mode: the axis about which it takes angular momentum from the hub, that momentum per
   modal rate, angular frequency [rad/s], displacement of the wing's tip along z. */
static const struct craft_mode {
  int axis;
  fb_real momentum, omega, tip;
} craft_mode[CRAFT_MODES] = {{1, FB_R(11.46924682), FB_R(2.399139082), FB_R(0.5756071308)},
                             {2, FB_R(-11.46924682), FB_R(9.596556329), FB_R(0.0)},
                             {1, FB_R(-2.771865842), FB_R(14.46478367), FB_R(0.5005489915)},
                             {1, FB_R(1.346627477), FB_R(39.20320503), FB_R(0.4453483301)},
                             {2, FB_R(2.771865842), FB_R(57.85913468), FB_R(0.0)},
                             {2, FB_R(-1.346627477), FB_R(156.8128201), FB_R(0.0)}};

#if GENERATED
#define satellite_IMPLEMENTATION
#include "satellite_code.h"

typedef satellite_state craft_state;
typedef satellite_motion craft_motion;

/* The model is code, no data to compare. */
static const char *craft_fault(void)
{
  return NULL;
}

static fb_status craft_start(craft_state *state)
{
  satellite_start(state);
  return FB_OK;
}

static fb_status craft_motion_eval(craft_motion *motion, const craft_state *state)
{
  return (fb_status)satellite_motion_eval(motion, state, NULL);
}

/* A step under a torque on the hub, body axes. */
static fb_status craft_step(craft_state *state, const fb_real torque[3], fb_real dt)
{
  satellite_input input = {0};
  memcpy(input.torque, torque, sizeof input.torque);
  return (fb_status)satellite_step(state, &input, &input, &input, dt);
}
#else
#include "satellite_rom.h" /* static const fb_body satellite */

typedef fb_state craft_state;
typedef fb_motion craft_motion;
static fb_rk4_work craft_work;

/* What is wrong with the model in memory, or with the numbers above, which are to be this model's; NULL: nothing. */
static const char *craft_fault(void)
{
  int same = satellite.n == CRAFT_MODES;
  if (fb_body_crc(&satellite) != satellite_crc) {
    return "the model in memory is not the one that was made\n";
  }
  for (int t = 0; t < satellite.n_lambda_constant; t++) { /* terms of Lambda hold -H */
    const fb_lambda_term *const term = &satellite.lambda[t];
    const struct craft_mode *const mode = &craft_mode[term->b];
    same &= term->i < 3 || (term->i - 3 == mode->axis && FB_FABS(term->c - mode->momentum) < FB_R(1e-4) &&
                            FB_FABS(satellite.node[1].psi[3 * term->b + 2] - mode->tip) < FB_R(1e-5));
  }
  return same ? NULL : "the controller knows other modes\n";
}

static fb_status craft_start(craft_state *state)
{
  return fb_state_init(&satellite, state);
}

static fb_status craft_motion_eval(craft_motion *motion, const craft_state *state)
{
  return fb_body_motion_eval(&satellite, motion, state, NULL);
}

/* A step under a torque on the hub, body axes. */
static fb_status craft_step(craft_state *state, const fb_real torque[3], fb_real dt)
{
  fb_input input = {0};
  input.n_load = 1;
  input.load[0].axes = FB_AXES_BODY;
  memcpy(input.load[0].torque, torque, sizeof input.load[0].torque);
  return fb_rk4_step(&satellite, state, &craft_work, &input, &input, &input, dt);
}
#endif
#endif
