/* Two bodies, each stepped by a thread of its own, against the same bodies stepped one after the other. */
#define _POSIX_C_SOURCE 200809L
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"
#include "../../examples/common/boom.h"
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
    input.load[0].torque[k % 3] = FB_R(0.3) * (fb_real)(k % 7 - 3);
    status = fb_rk4_step(model, state, &work, &input, &input, &input, FB_R(1e-3));
  }
  return status;
}

/* Ends the program when the library refuses something. */
static void must(fb_status status, const char *what)
{
  if (status != FB_OK) {
    printf("%s: %s\n", what, fb_status_string(status));
    exit(1);
  }
}

static void *thread(void *number)
{
  const int k = *(const int *)number;
  must(run(&together[k], &body[k]), "step");
  return NULL;
}

int main(void)
{
  const fb_real v[3] = {0}, w[3] = {FB_R(0.1), FB_R(-0.2), FB_R(0.3)};
  int number[BODIES];
  pthread_t id[BODIES];
  must(boom_craft(&body[0], FB_BASE_FREE, 3, 3, 0, FB_EFFECTS_FULL, FB_R(0.0)), "body");
  must(boom_craft(&body[1], FB_BASE_FREE, 2, 2, 0, FB_EFFECTS_FULL | FB_EFFECT_DAMPING, FB_R(0.01)), "body");
  for (int k = 0; k < BODIES; k++) {
    number[k] = k;
    must(fb_state_init(&body[k], &alone[k]), "state");
    for (int a = 0; a < body[k].n; a++) {
      alone[k].q[a] = FB_R(0.02) * (fb_real)(a - 2);
    }
    must(fb_state_from_velocity(&body[k], &alone[k], v, w, NULL), "state");
    together[k] = alone[k];
    must(run(&alone[k], &body[k]), "step");
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
