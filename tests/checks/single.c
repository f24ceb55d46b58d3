/* A tumbling, swinging boom for 10 s: attitude rates and tip every 5 ms, printed for check-single to compare. Compile
   with -DSTEP, [s] of a step. */
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"
#include "boom.h" /* static const fb_body boom, node 1 its tip */
#include <stdio.h>

int main(void)
{
  static const fb_real v[3] = {0}, w[3] = {FB_R(0.1), FB_R(0.3), FB_R(1.0)}; /* [m/s], [rad/s] */
  static const fb_real q_dot[FB_MAX_MODES] = {FB_R(0.5), -FB_R(0.3)};
  fb_state state;
  fb_rk4_work work;
  fb_motion motion;
  fb_node_motion tip;
  fb_status status = fb_state_init(&boom, &state);
  status = status ? status : fb_state_from_velocity(&boom, &state, v, w, q_dot);
  for (int sample = 0; sample < 2000 && status == FB_OK; sample++) {
    for (int k = (int)(0.005 / STEP + 0.5); k > 0; k--) {
      status = status ? status : fb_rk4_step(&boom, &state, &work, NULL, NULL, NULL, (fb_real)STEP);
    }
    status = status ? status : fb_body_motion_eval(&boom, &motion, &state, NULL);
    status = status ? status : fb_body_node_motion_eval(&boom, &tip, &state, &motion, 1);
    printf("%.9g %.9g %.9g\n", (double)tip.displacement[1], (double)tip.displacement[2], (double)motion.w[2]);
  }
  printf("%s\n", fb_status_string(status));
  return status != FB_OK;
}
