/* Float and double in one program: this file is compiled twice, each time with a private copy of the library
   (FLEXBEAM_STATIC), and the two spin-ups of a beam are compared. */
#define FLEXBEAM_STATIC
#include "flexbeam.h"
#include "../../examples/common/boom.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

#define SAMPLES 3000

int single_run(double tip[SAMPLES]);
int double_run(double tip[SAMPLES]);

/* The spin-up of p07C: a boom whose root is brought to 6 rad/s in 15 s; tip displacement in the plane every 10 ms for
   30 s. 0 if a call failed. */
static int run(double tip[SAMPLES])
{
  static const boom reference = {BOOM_LENGTH, BOOM_MASS, BOOM_EI, BOOM_EA, 2, 0, 0, 0, 0};
  static fb_beam_desc beam_desc;
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_shape shape;
  static fb_body body;
  static fb_body_work body_work;
  fb_modes_desc keep;
  fb_body_desc desc;
  fb_state state;
  fb_rk4_work work;
  int status, node = 0;
  memset(&keep, 0, sizeof keep);
  memset(&desc, 0, sizeof desc);
  boom_beam(&beam_desc, &reference, 5);
  keep.count[FB_KIND_BEND_Y] = 3;
  desc.effects = FB_EFFECTS_FULL;
  desc.base = FB_BASE_PRESCRIBED;
  status = fb_beam_init(&beam, &beam_desc);
  status |= fb_modes_solve(&modes, &modes_work, &beam, &keep);
  status |= fb_shape_init(&shape, modes.n);
  status |= fb_shape_add_beam(&shape, 0, &beam, &modes);
  status |= fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, beam_desc.length);
  status |= fb_body_init(&body, &body_work, &shape, &desc);
  status |= fb_state_init(&body, &state);
  for (int k = 0; k < 10 * SAMPLES && status == FB_OK; k++) {
    fb_input input[3];
    memset(input, 0, sizeof input);
    for (int i = 0; i < 3; i++) {
      const double t = 1e-3 * (k + 0.5 * i), s = t < 15.0 ? t / 15.0 : 1.0;
      input[i].w[2] = (fb_real)(6.0 * (s - sin(6.283185307179586 * s) / 6.283185307179586));
    }
    status = fb_rk4_step(&body, &state, &work, &input[0], &input[1], &input[2], FB_R(0.001));
    tip[k / 10] = 0.0;
    for (int a = 0; a < body.n; a++) {
      tip[k / 10] += (double)body.node[node].psi[3 * a + 1] * (double)state.q[a];
    }
  }
  return status == FB_OK;
}

#if FB_SINGLE
int single_run(double tip[SAMPLES])
{
  return run(tip);
}
#else
int double_run(double tip[SAMPLES])
{
  return run(tip);
}

int main(void)
{
  static double in_double[SAMPLES], in_single[SAMPLES];
  double peak = 0.0, most = 0.0;
  if (!double_run(in_double) || !single_run(in_single)) {
    printf("a run failed\n");
    return 1;
  }
  for (int k = 0; k < SAMPLES; k++) {
    peak = fmax(peak, fabs(in_double[k]));
    most = fmax(most, fabs(in_single[k] - in_double[k]));
  }
  printf("spin-up over 30 s: the tip is %.1e of its peak apart (peak %.3f m)\n", most / peak, peak);
  return !(most > 0.0 && most < 1e-3 * peak);
}
#endif
