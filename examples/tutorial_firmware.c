/* tutorial_firmware - what flies: a model in ROM, a state in RAM, one step per period, and what to do when a step
   fails. It shows: a model that `reduce` wrote (examples/satellite.txt, single precision), its check word, snapshots,
   statuses. Nothing that builds models is linked; the target compiles the same lines (examples/firmware/README.md).
   Check: a replay from a snapshot gives the same bits, a flipped bit of the model is detected, a refused step changes
   nothing, and the angular momentum is what the torque brought, 10 N m s, and stays. Exit: 0 well, 1 a check failed. */
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#include "satellite_rom.h" /* static const fb_body satellite, satellite_crc */
#include <stdio.h>
#include <string.h>

static const fb_real period = FB_R(0.001); // [s]
static fb_state state;                     // all that changes
static fb_rk4_work work;                   // scratch, meaningless between steps

/* What a timer interrupt does every millisecond: sensors in, one step, actuators out. */
static fb_status on_tick(const fb_real torque[3])
{
  fb_input input = {.n_load = 1, .load = {{.axes = FB_AXES_BODY}}}; // on node 0, the hub
  memcpy(input.load[0].torque, torque, sizeof input.load[0].torque);
  return fb_rk4_step(&satellite, &state, &work, &input, &input, &input, period);
}

/* Two seconds of torque, then six without. */
static fb_status maneuver(void)
{
  fb_status status = FB_OK;
  for (int k = 0; k < 8000 && status == FB_OK; k++) {
    const fb_real torque[3] = {0, k < 2000 ? FB_R(5.0) : 0, 0}; // [N m]
    status = on_tick(torque);
  }
  return status;
}

int main(void)
{
  static fb_body damaged;
  static fb_state snapshot, first;
  const fb_real huge[3] = {FB_R(1e30), 0, 0};
  fb_momentum before, after;
  fb_status status, refused;
  int replayed, detected, kept;
  if (fb_body_crc(&satellite) != satellite_crc) { // at start-up: is the ROM what was written?
    printf("the model is damaged\n");
    return 1;
  }
  status = fb_state_init(&satellite, &state);

  snapshot = state; // assignment is a snapshot
  status = status ? status : maneuver();
  first = state;
  state = snapshot;
  status = status ? status : maneuver();
  replayed = memcmp(&first, &state, sizeof state) == 0;

  first = state;
  refused = on_tick(huge); // a torque that no sensor or controller should ask for
  kept = refused != FB_OK && memcmp(&first, &state, sizeof state) == 0;

  damaged = satellite;
  damaged.K.diagonal[2] = -damaged.K.diagonal[2]; // one bit: the sign of a stiffness
  detected = fb_body_crc(&damaged) != satellite_crc && fb_body_check(&damaged) != FB_OK;

  status = status ? status : fb_body_momentum_eval(&satellite, &before, &state, NULL);
  for (int k = 0; k < 10000 && status == FB_OK; k++) { // ten seconds without any torque
    const fb_real none[3] = {0};
    status = on_tick(none);
  }
  status = status ? status : fb_body_momentum_eval(&satellite, &after, &state, NULL);
  if (status != FB_OK) {
    printf("%s\n", fb_status_string(status));
    return 1;
  }
  printf("model %lu bytes in ROM, state %lu, work %lu bytes in RAM\n", (unsigned long)sizeof satellite,
         (unsigned long)sizeof state, (unsigned long)sizeof work);
  printf("replay: %s; huge torque: %s; damaged model: %s\n", replayed ? "same bits" : "other bits",
         fb_status_string(refused), detected ? "detected" : "not detected");
  printf("angular momentum about y: %.5f N m s, ten seconds later %.5f\n", (double)before.angular[1],
         (double)after.angular[1]);
  if (!(replayed && kept && detected && FB_FABS(before.angular[1] - 10) < FB_R(1e-3) &&
        FB_FABS(after.angular[1] - 10) < FB_R(1e-3))) {
    printf("a check failed\n");
    return 1;
  }
  return fflush(stdout) == 0 ? 0 : 1;
}
