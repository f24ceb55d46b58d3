/* How the momenta change with the shape, d/dq (Lambda(q) pb + S(q) V), which the implicit integrators solve with,
   against central differences: a boom on a hub, modes of both planes, every base. Double precision. */
#define FLEXBEAM_STATIC
#include "flexbeam.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static fb_beam_desc boom;
static fb_beam beam;
static fb_modes modes;
static fb_modes_work modes_work;
static fb_shape shape;
static fb_body body;
static fb_body_work body_work;

static void require(fb_status status)
{
  if (status != FB_OK) {
    printf("%s\n", fb_status_string(status));
    exit(1);
  }
}

static void build(fb_base base)
{
  static const double center[3] = {0.3, -0.2, 0.1}, inertia[6] = {20, 30, 25, 1, -2, 0.5};
  fb_modes_desc keep;
  fb_body_desc desc;
  memset(&boom, 0, sizeof boom);
  memset(&keep, 0, sizeof keep);
  memset(&desc, 0, sizeof desc);
  boom.length = 4;
  boom.n_element = 6;
  boom.n_station = 2;
  for (int k = 0; k < 2; k++) {
    boom.station[k].x = 4.0 * k;
    boom.station[k].mass = 2;
    boom.station[k].EI_y = 90;
    boom.station[k].EI_z = 160;
    boom.station[k].twist = 0.7 * k; /* every element of Lambda and S */
  }
  keep.lowest = 5;
  desc.effects = FB_EFFECTS_FULL;
  desc.base = base;
  require(fb_beam_init(&beam, &boom));
  require(fb_modes_solve(&modes, &modes_work, &beam, &keep));
  require(fb_shape_init(&shape, modes.n));
  require(fb_shape_add_rigid(&shape, 50, center, inertia));
  require(fb_shape_add_beam(&shape, 0, &beam, &modes));
  require(fb_body_init(&body, &body_work, &shape, &desc));
}

/* Lambda(q) pb + S(q) V */
static void momenta(double y[6], fbi_kinetics *k)
{
  double SV[6];
  fbi_zero(y, 6);
  fbi_lambda_linear_eval(k->D, &body, k->qx);
  fbi_lambda_sub(y, &body, k->D, k->pb);
  fbi_S_eval(k->S, &body, k->qx, body.n_S);
  fb_sym6_mul_vec6(SV, k->S, k->V);
  for (int i = 0; i < 6; i++) {
    y[i] = SV[i] - y[i];
  }
}

int main(void)
{
  static const fb_base bases[3] = {FB_BASE_FREE, FB_BASE_PINNED, FB_BASE_HINGED};
  double worst = 0;
  for (int run = 0; run < 3; run++) {
    static fbi_kinetics k;
    double D[6 * FB_MAX_MODES], pb[FB_MAX_MODES], most = 0, size = 0;
    int first;
    build(bases[run]);
    first = fbi_first_free(body.base);
    k.qx[0] = 1;
    k.pb = pb;
    for (int a = 0; a < body.n; a++) {
      k.qx[a + 1] = 0.1 * sin(a + 1.0);
      pb[a] = cos(2.0 * a + run);
    }
    for (int i = 0; i < 6; i++) {
      k.V[i] = sin(3.0 * i + 1);
    }
    fbi_shape_rates(D, &k, &body, first);
    for (int a = 0; a < body.n; a++) {
      const double h = 1e-3, q = k.qx[a + 1]; /* a polynomial of second degree: exact */
      double forward[6], back[6];
      k.qx[a + 1] = q + h;
      momenta(forward, &k);
      k.qx[a + 1] = q - h;
      momenta(back, &k);
      k.qx[a + 1] = q;
      for (int i = first; i < 6; i++) {
        const double d = (forward[i] - back[i]) / (2 * h);
        size = fmax(size, fabs(d));
        most = fmax(most, fabs(d - D[(i - first) * body.n + a]));
      }
    }
    worst = fmax(worst, most / size);
  }
  printf("rates of the momenta with the shape within %.1e of differences\n", worst);
  return !(worst < 1e-10);
}
