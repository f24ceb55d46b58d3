/* lanes - body-steps per second of fb_rk4_step, of the generated step and of its lanes, each the best of REPEATS runs that
   take turns in one program, and that lanes end at the bits of single steps; for bench/lanes.sh, which generates code.h
   with lanes and parameters and the model rom.h. One line: lanes, millions of body-steps per second, ratios to the library. */
#define _POSIX_C_SOURCE 200112L /* clock_gettime */
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"
#define generated_IMPLEMENTATION
#include "code.h"
#include "rom.h"
#include "../examples/common/clock.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { REPEATS = 60, STEPS = 400 };

static fb_state library[generated_LANES];
static generated_state single[generated_LANES];
static generated_model model[generated_LANES];
static generated_lanes_state lanes;
static generated_lanes_model lanes_model;

/* Different states of the library and of the step, with the parameters of the description. */
static int begin(void)
{
  int good = 1;
  for (int k = 0; k < generated_LANES; k++) {
    fb_state *const state = &library[k];
    good &= fb_state_init(&generated, state) == FB_OK && generated_model_init(&model[k], NULL) == generated_ok;
    generated_start(&single[k]);
    state->L[2] = single[k].L[2] = FB_R(30.0) + (fb_real)k;
    state->L[0] = single[k].L[0] = FB_R(20.0);
    state->q[0] = single[k].q[0] = FB_R(0.05);
    generated_lanes_put(&lanes, k, &single[k]);
    generated_lanes_put_model(&lanes_model, k, &model[k]);
  }
  return good;
}

/* Steps of all lanes by what is measured, 0: library, 1: single steps, 2: lanes; time of a body's step [ns]. */
static double run(int which, int *good)
{
  static fb_rk4_work work;
  const fb_real dt = FB_R(1e-3);
  const double from = clock_ns();
  for (int i = 0; i < STEPS; i++) {
    for (int k = 0; k < generated_LANES && which < 2; k++) {
      *good &= which == 0 ? fb_rk4_step(&generated, &library[k], &work, NULL, NULL, NULL, dt) == FB_OK
                          : generated_step(&model[k], &single[k], NULL, NULL, NULL, dt) == generated_ok;
    }
    *good &= which < 2 || generated_lanes_step(&lanes_model, &lanes, NULL, NULL, NULL, dt, NULL) == generated_ok;
  }
  return (clock_ns() - from) / (STEPS * (double)generated_LANES);
}

int main(void)
{
  double best[3] = {1e30, 1e30, 1e30};
  int good = begin();
  for (int r = 0; r < REPEATS; r++) {
    for (int which = 0; which < 3; which++) {
      best[which] = fmin(best[which], run(which, &good));
    }
  }
  for (int k = 0; k < generated_LANES; k++) {
    generated_state own;
    generated_lanes_take(&own, &lanes, k);
    good &= memcmp(&own, &single[k], sizeof own) == 0;
  }
  if (!good) {
    printf("a step is refused, or lanes differ from single steps\n");
    return 1;
  }
  printf("%6d %12.2f %12.2f %12.2f %10.1f %10.1f\n", generated_LANES, 1e3 / best[0], 1e3 / best[1], 1e3 / best[2],
         best[0] / best[1], best[0] / best[2]);
  return 0;
}
