/* spectrum.h - what of eigenvalues is rounding becomes zero. */
#ifndef SPECTRUM_H
#define SPECTRUM_H
#include <math.h>

/* Sets to zero the growth of modes that are undamped, by the fastest of all and by their own frequency, and both parts of
   motions at the root of rounding, as which double eigenvalues at zero (rigid motion, two equal moments of inertia) come
   out. Returns the least growth [1/s] that is left. */
static inline double spectrum_drop_rounding(fb_real *re, fb_real *im, int n)
{
  double fastest = 0, least;
  for (int k = 0; k < n; k++) {
    fastest = fmax(fastest, hypot((double)re[k], (double)im[k]));
  }
  least = 4096 * (double)FB_EPSILON * fastest;
  for (int k = 0; k < n; k++) {
    const double size = hypot((double)re[k], (double)im[k]);
    const int still = size < 16 * sqrt((double)FB_EPSILON) * fastest;
    if (still || fabs((double)re[k]) < fmax(least, 262144 * (double)FB_EPSILON * size)) {
      re[k] = FB_R(0.0);
    }
    if (still) {
      im[k] = FB_R(0.0);
    }
  }
  return least;
}
#endif
