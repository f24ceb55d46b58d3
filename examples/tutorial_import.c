/* tutorial_import - a solar array wing from a finite-element program, on a satellite that a thruster pushes.
   It shows: a component from a text file (node masses, mode shapes, frequencies: examples/tools/README.md), its use as
   a body, and the frequencies of the free satellite, which are not those of the wing on a fixed interface.
   Check: on a fixed interface the frequencies of the file; free ones above them, mode by mode; a push changes momentum
   by its impulse. Run it at the top of the project, or name the file. Exit: 0 well, 1 a check failed, 2 a bad file. */
#include "tools/capacities.h" /* of build/flexbeam: larger models than by default */
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "tools/model.h" /* reads the file: model, model_body and so on are its variables */

static fb_analyse_work work;
static fb_spectrum spectrum;

/* Frequencies [Hz] of the elastic modes of the body that was read, on a base of that kind. */
static fb_status frequencies(double *hz, fb_base base)
{
  const char *what;
  const fb_input input = {0};
  fb_state state;
  int found = 0;
  fb_status status;
  model.level.base = base;
  status = model_build(&what);
  status = status ? status : fb_state_init(&model_body, &state);
  status = status ? status : fb_body_spectrum_solve(&model_body, &work, &spectrum, &state, &input);
  for (int k = 0; k < spectrum.n && status == FB_OK && found < model.part[0].n_mode; k++) {
    const double f = hypot((double)spectrum.re[k], (double)spectrum.im[k]) / (2 * model_pi);
    if (f > 0.01) { // the modes of a free body that come before are rigid ones, at zero
      hz[found++] = f;
    }
  }
  return status || found == model.part[0].n_mode ? status : FB_ERR_MODES;
}

int main(int argc, char **argv)
{
  const char *file = argc > 1 ? argv[1] : "examples/panel.txt";
  const double push = 20, duration = 5; /* [N], [s] */
  fb_input input = {.n_load = 1,
                    .load = {{.axes = FB_AXES_INERTIAL, .force = {0, 0, (fb_real)push}}}}; // on node 0: the hub
  double fixed[FB_MAX_MODES], free[FB_MAX_MODES], worst = 0, ratio;
  fb_momentum momentum;
  fb_state state;
  fb_rk4_work rk4;
  fb_status status;
  int ordered = 1;
  if (!model_read("tutorial_import", file)) {
    return 2;
  }
  status = frequencies(fixed, FB_BASE_PRESCRIBED);
  status = status ? status : frequencies(free, FB_BASE_FREE);
  for (int a = 0; a < model.part[0].n_mode && status == FB_OK; a++) {
    printf("mode %d: file %8.5f Hz, fixed interface %8.5f Hz, free satellite %8.5f Hz\n", a + 1,
           model.part[0].frequency[a], fixed[a], free[a]);
    worst = fmax(worst, fabs(fixed[a] / model.part[0].frequency[a] - 1));
    ordered &= free[a] > fixed[a] * (1 - 1e-6);
  }
  status = status ? status : fb_state_init(&model_body, &state);
  for (int k = 0; k < 5000 && status == FB_OK; k++) { // the thruster, in steps of 1 ms
    status = fb_rk4_step(&model_body, &state, &rk4, &input, &input, &input, (fb_real)(duration / 5000));
  }
  status = status ? status : fb_body_momentum_eval(&model_body, &momentum, &state, &input);
  if (status != FB_OK) {
    printf("%s: %s\n", file, fb_status_string(status));
    return 1;
  }
  ratio = sqrt((double)fb_vec3_dot(momentum.linear, momentum.linear)) / (push * duration);
  printf("after the push: momentum / impulse %.9f\n", ratio);
  if (!(worst < 1e-5 && ordered && fabs(ratio - 1) < 1e-9)) {
    printf("a check failed\n");
    return 1;
  }
  return fflush(stdout) == 0 ? 0 : 1;
}
