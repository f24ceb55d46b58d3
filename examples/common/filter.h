/* filter.h - a linear filter of second order at a fixed period: roll-off, notch. */
#ifndef FILTER_H
#define FILTER_H
#include <math.h>
#include <string.h>

typedef struct filter { /* y = b0 x + b1 x' + b2 x'' - a1 y' - a2 y'', primes: one and two periods ago */
  double b[3], a[2], state[2];
} filter;

/* (n2 s^2 + n1 s + n0) / (s^2 + d1 s + d0) by the bilinear transform, exact at the frequency w [rad/s]. */
static inline void filter_init(filter *f, double n2, double n1, double n0, double d1, double d0, double w,
                               double period)
{
  const double k = w / tan(0.5 * w * period); /* s = k (z - 1)/(z + 1) */
  const double d = k * k + d1 * k + d0;
  memset(f, 0, sizeof *f);
  f->b[0] = (n2 * k * k + n1 * k + n0) / d;
  f->b[1] = 2 * (n0 - n2 * k * k) / d;
  f->b[2] = (n2 * k * k - n1 * k + n0) / d;
  f->a[0] = 2 * (d0 - k * k) / d;
  f->a[1] = (k * k - d1 * k + d0) / d;
}

static inline double filter_step(filter *f, double x)
{
  const double y = f->b[0] * x + f->state[0];
  f->state[0] = f->b[1] * x - f->a[0] * y + f->state[1];
  f->state[1] = f->b[2] * x - f->a[1] * y;
  return y;
}
#endif
