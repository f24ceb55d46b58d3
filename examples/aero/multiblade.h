/* multiblade.h - multiblade (Coleman) coordinates: what a rotor's blades do together, seen without rotation. */
#ifndef MULTIBLADE_H
#define MULTIBLADE_H
#include <math.h>

typedef struct multiblade {
  double mean, cosine, sine; /* coning; flap: tilt of the disc; lag: its mass center sideward */
  double differential;       /* of neighbors, an even number of blades; else 0 */
} multiblade;

/* [A9] Of the angles of three or more blades, blade k at azimuth + 2 pi k/blades: x_k = mean + cosine cos psi_k +
   sine sin psi_k + differential (-1)^k, all that there is of three and of four blades. R. P. Coleman and A. M. Feingold,
   NACA report 1351, 1958; W. Johnson, Helicopter Theory, 1980, section 8-4. */
static inline multiblade multiblade_of(const double *angle, int blades, double azimuth)
{
  const double turn = 6.28318530717958648 / blades;
  multiblade m = {0, 0, 0, 0};
  for (int k = 0; k < blades; k++) {
    const double psi = azimuth + turn * k;
    m.mean += angle[k] / blades;
    m.cosine += 2 * angle[k] * cos(psi) / blades;
    m.sine += 2 * angle[k] * sin(psi) / blades;
    m.differential += blades % 2 ? 0 : (k % 2 ? -angle[k] : angle[k]) / blades;
  }
  return m;
}
#endif
