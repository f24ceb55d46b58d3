/* Float and double in one program: this file is compiled twice, each time with a private copy of the library
   (FLEXBEAM_STATIC), and the two runs of a spinning beam are compared. */
#define FLEXBEAM_STATIC
#include "flexbeam.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

double single_run(void);
double double_run(void);

/* Tip mode of a boom that is pushed for 0.2 s, or NaN when a call failed. */
static double run(void)
{
  static const fb_real center[3] = {0}, inertia[6] = {10, 10, 10}; /* [m], [kg m^2] */
  static fb_beam_desc boom;
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_shape shape;
  static fb_body body;
  static fb_body_work body_work;
  fb_modes_desc keep;
  fb_body_desc desc;
  fb_input torque;
  fb_state state;
  fb_rk4_work work;
  int status;
  memset(&keep, 0, sizeof keep);
  memset(&desc, 0, sizeof desc);
  memset(&torque, 0, sizeof torque);
  boom.length = 5; /* [m] */
  boom.n_element = 5;
  boom.n_station = 1;
  boom.station[0].mass = 1;                                /* [kg/m] */
  boom.station[0].EI_y = boom.station[0].EI_z = FB_R(1e3); /* [N m^2] */
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 2;
  desc.effects = FB_EFFECTS_FULL;
  torque.n_load = 1;
  torque.load[0].torque[2] = 20; /* [N m] */
  status = fb_beam_init(&beam, &boom);
  status |= fb_modes_solve(&modes, &modes_work, &beam, &keep);
  status |= fb_shape_init(&shape, modes.n);
  status |= fb_shape_add_rigid(&shape, 100, center, inertia);
  status |= fb_shape_add_beam(&shape, 0, &beam, &modes);
  status |= fb_body_init(&body, &body_work, &shape, &desc);
  status |= fb_state_init(&body, &state);
  for (int k = 0; k < 200 && status == FB_OK; k++) {
    status = fb_rk4_step(&body, &state, &work, &torque, &torque, &torque, FB_R(0.001));
  }
  return status == FB_OK ? (double)state.q[0] : (double)NAN;
}

#if FB_SINGLE
double single_run(void)
{
  return run();
}
#else
double double_run(void)
{
  return run();
}

int main(void)
{
  const double in_double = double_run(), in_single = single_run();
  const double difference = fabs(in_single / in_double - 1.0);
  printf("relative difference %.1e\n", difference);
  return !(difference > 0.0 && difference < 1e-3);
}
#endif
