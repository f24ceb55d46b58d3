/* Two bodies, each stepped by a thread of its own, against the same bodies stepped one after the other. */
#define _POSIX_C_SOURCE 200809L
#define FLEXBEAM_IMPLEMENTATION
#include "bench/scene.h"
#include <pthread.h>

#define BODIES 2
#define RUN_STEPS 20000

static fb_body body[BODIES];
static fb_state alone[BODIES], together[BODIES];

static fb_status run(fb_state *state, const fb_body *model)
{
  fb_rk4_work work;
  fb_input input;
  fb_status status = FB_OK;
  memset(&input, 0, sizeof input);
  input.n_load = 1;
  for (int k = 0; k < RUN_STEPS && status == FB_OK; k++) {
    input.load[0].torque[k % 3] = fbb_random(k);
    status = fb_rk4_step(model, state, &work, &input, &input, &input, FB_R(1e-3));
  }
  return status;
}

static void *thread(void *number)
{
  const int k = *(const int *)number;
  fbb_check(run(&together[k], &body[k]), "step");
  return NULL;
}

int main(void)
{
  int number[BODIES];
  pthread_t id[BODIES];
  fbb_body(&body[0], FB_BASE_FREE, 3, 3, 0, FB_EFFECTS_FULL, FB_R(0.0));
  fbb_body(&body[1], FB_BASE_FREE, 2, 2, 0, FB_EFFECTS_FULL | FB_EFFECT_DAMPING, FB_R(0.01));
  for (int k = 0; k < BODIES; k++) {
    number[k] = k;
    fbb_state(&alone[k], &body[k], k, FB_R(0.3), FB_R(0.1));
    together[k] = alone[k];
    fbb_check(run(&alone[k], &body[k]), "step");
  }
  for (int k = 0; k < BODIES; k++) {
    if (pthread_create(&id[k], NULL, thread, &number[k]) != 0) {
      printf("no thread\n");
      return 1;
    }
  }
  for (int k = 0; k < BODIES; k++) {
    (void)pthread_join(id[k], NULL);
  }
  printf("two bodies, %d steps each, by two threads: %s\n", RUN_STEPS,
         memcmp(alone, together, sizeof alone) == 0 ? "the bits of each alone" : "other bits");
  return memcmp(alone, together, sizeof alone) != 0;
}
