/* step_count - steps one body, for a counter of instructions (tests/checks/instructions.sh).
   usage: step_count Y Z AXIAL EFFECTS STEPS [decayed]
   Y, Z, AXIAL: modes of each kind; EFFECTS: mask of FB_EFFECT_...; decayed: the elastic motion is about to vanish. */
#include "scene.h"

int main(int argc, char **argv)
{
  static fb_body body;
  fb_rk4_work work;
  fb_state state;
  const int decayed = argc == 7;
  fb_real dt;
  if (argc < 6) {
    fprintf(stderr, "usage: step_count Y Z AXIAL EFFECTS STEPS [decayed]\n");
    return 2;
  }
  fbb_body(&body, atoi(argv[1]), atoi(argv[2]), atoi(argv[3]), (unsigned)atoi(argv[4]), FB_R(0.5));
  fbb_state(&state, &body, 0, decayed ? FB_R(0.0) : FB_R(1.0), decayed ? (fb_real)1e-133 : FB_R(0.01));
  dt = FB_R(0.5) * fb_rk4_limit(&body, FB_R(2.0), FB_R(10.0));
  dt = dt < FB_R(0.01) ? dt : FB_R(0.01);
  for (int k = atoi(argv[5]); k > 0; k--) {
    fbb_check(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, dt), "step");
  }
  printf("n = %d, q[0] = %g, n_lambda = %d, n_S = %d\n", body.n, (double)state.q[0], body.n_lambda, body.n_S);
  return 0;
}
