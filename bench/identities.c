/* identities - how much of a beam's inertia its modes hold: the inertial identities [DB] (43), (46) summed over the
   modes kept, as parts of what they add up to with all of them (`make readme`). Uniform cantilever, 10 m, 12 kg, with
   torsion. */
#define FB_MAX_MODES 48
#define FB_MAX_ELEMENTS 20
#define FB_WITH_NONLINEAR_STRAIN 0
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"
#include "check.h"
#include "../examples/common/boom.h"
#include "../examples/common/output.h"

static fb_beam_desc desc;
static fb_beam beam;
static fb_modes modes;
static fb_modes_work work;
static fb_shape shape;

/* Trace of sum_a x_a y_a^T over the coordinates, rows of three. */
static double sum(const fb_real *x, const fb_real *y)
{
  double total = 0;
  for (int i = 0; i < 3 * shape.n; i++) {
    total += (double)x[i] * (double)y[i];
  }
  return total;
}

int main(void)
{
  static const boom reference = {BOOM_LENGTH, BOOM_MASS, BOOM_EI, BOOM_EA, 2, 0, 0, 0, 0};
  static fb_modes_desc keep;
  output_begin("identities");
  boom_beam(&desc, &reference, 20);
  desc.station[0].EA = FB_R(1.2e6);
  desc.station[0].GJ = FB_R(1e4);
  desc.station[0].EI_y = FB_R(9000.0);
  desc.station[0].i_y = desc.station[0].i_z = FB_R(1e-3);
  fbb_check(fb_beam_init(&beam, &desc), "beam");
  printf("modes a kind    sum p p^T / m    sum h h^T / J    sum ups ups^T / Pi_11\n");
  for (int n = 1; n <= 12; n += n < 4 ? 1 : 4) {
    for (int kind = 0; kind < FB_KIND_COUNT; kind++) {
      keep.count[kind] = n;
    }
    fbb_check(fb_modes_solve(&modes, &work, &beam, &keep), "modes");
    fbb_check(fb_shape_init(&shape, modes.n), "shape");
    fbb_check(fb_shape_add_beam(&shape, 0, &beam, &modes), "integrals");
    printf("%12d %16.6f %16.6f %24.6f\n", n, sum(shape.P, shape.P) / (3 * (double)shape.mass),
           sum(shape.H, shape.H) / (double)(shape.J[0] + shape.J[4] + shape.J[8]),
           sum(shape.second.ups, shape.second.ups) /
               (double)(shape.second.Pi[0] + shape.second.Pi[4] + shape.second.Pi[8]));
  }
  return 0;
}
