/* one_body.c - steady state, linear model and spectrum of one body, for rooms.sh: without systems they are the same, to
   the last bit. A boom on a held base vibrates at the frequencies of its modes. */
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"
#include <math.h>
#include <stdio.h>

static fb_body body;
static fb_build_work build_work;
static fb_analyse_work work;
static fb_linear linear;
static fb_spectrum spectrum;

int main(void)
{
  const fb_beam_desc boom = {
      .length = 10, .n_element = 4, .n_station = 1, .station = {{.mass = 1, .EI_y = 1e4, .EI_z = 2e4}}};
  const fb_modes_desc keep = {.count = {2, 2}};
  const fb_build_desc craft = {.n_part = 1,
                               .part = {{.n_node = 1, .node = {10}}},
                               .body = {.effects = FB_EFFECTS_FULL, .base = FB_BASE_PRESCRIBED}};
  const fb_linear_desc ports = {.n_out = 1, .out = {{.kind = FB_PORT_DISPLACEMENT, .node = 1, .axis = 1}}};
  const fb_input input = {.n_load = 0};
  fb_state state;
  fb_status status = fb_body_build(&body, &build_work, &craft, &boom, &keep, 1);
  status = status ? status : fb_state_init(&body, &state);
  status = status ? status : fb_body_trim(&body, &state, &work, &input);
  status = status ? status : fb_body_linearize(&body, &work, &linear, &state, &input, &ports);
  status = status ? status : fb_body_spectrum_solve(&body, &work, &spectrum, &state, &input);
  if (status != FB_OK || spectrum.n != 4 || linear.n != 8) {
    printf("%s\n", fb_status_string(status));
    return 1;
  }
  for (int k = 0; k < 4; k++) {
    printf("%a %a\n", (double)spectrum.re[k], (double)spectrum.im[k]);
    if (fabs((double)spectrum.im[k] / sqrt((double)body.K.diagonal[k]) - 1.0) > (FB_SINGLE ? 1e-3 : 1e-9)) {
      return 1;
    }
  }
  for (int k = 0; k < 64; k++) {
    printf("%a\n", (double)linear.A[k]);
  }
  for (int k = 0; k < 8; k++) {
    printf("%a\n", (double)linear.C[k]);
  }
  return fflush(stdout) == 0 ? 0 : 1;
}
