/* spin_up.h - the scene of the peers: a beam of 10 m on a hub that turns with a prescribed rate up to 6 rad/s in 15 s, 30 s
   in all. Include flexbeam.h first. */
#ifndef FBB_SPIN_UP_H
#define FBB_SPIN_UP_H

#include "../examples/common/boom.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define SPIN_UP_END 30.0 /* [s] */
#define SPIN_UP_RAMP 15.0
#define SPIN_UP_RATE 6.0 /* [rad/s] */
#define SPIN_UP_TURN (2 * 3.14159265358979323846 / SPIN_UP_RAMP)

/* [rad/s], [rad/s^2] of the hub at t */
static inline double spin_up_rate(double t)
{
  return t < SPIN_UP_RAMP ? SPIN_UP_RATE / SPIN_UP_RAMP * (t - sin(SPIN_UP_TURN * t) / SPIN_UP_TURN) : SPIN_UP_RATE;
}

static inline double spin_up_acceleration(double t)
{
  return t < SPIN_UP_RAMP ? SPIN_UP_RATE / SPIN_UP_RAMP * (1 - cos(SPIN_UP_TURN * t)) : 0.0;
}

static inline void spin_up_drive(fb_input *input, double t)
{
  input->w[2] = (fb_real)spin_up_rate(t);
  input->w_dot[2] = (fb_real)spin_up_acceleration(t);
}

static inline void spin_up_require(int ok, const char *program, const char *what)
{
  if (!ok) {
    fprintf(stderr, "%s: %s\n", program, what);
    exit(1);
  }
}
#endif
