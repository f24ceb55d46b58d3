/* step_cost - what a step of rk4 takes of the machine it runs on, for the body of a ROM header and no more than it
   needs: on a board instructions and stack, on the desktop nanoseconds. bench/sizes.sh makes a table of it.
   Compile with -DBODY_HEADER, a header that reduce made, and -DBODY, the name in it; on the desktop -DDESKTOP. */
#ifdef DESKTOP
#define _POSIX_C_SOURCE 199309L /* clock_gettime */
#include "../examples/common/clock.h"
#include <stdio.h>
#endif
#include "../examples/firmware/board/board.h"
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"
#include BODY_HEADER

static fb_state state;
static fb_rk4_work work;
static fb_input input; /* unloaded */

static fb_status step(void)
{
  return fb_rk4_step(&BODY, &state, &work, &input, &input, &input, FB_R(0.001));
}

#ifdef DESKTOP
/* Nanoseconds of a step, the median of 101 runs. */
static double nanoseconds(void)
{
  double sample[101];
  for (int run = 0; run < 101; run++) {
    const double start = clock_ns();
    for (int k = 0; k < 200; k++) {
      (void)step();
    }
    sample[run] = (clock_ns() - start) / 200;
  }
  return clock_timing_of(sample, 101).median;
}
#endif

int main(void)
{
  const fb_real v[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)}, w[3] = {FB_R(0.01), FB_R(0.02), FB_R(0.03)};
  fb_status status = fb_state_init(&BODY, &state);
  status = status ? status : fb_state_from_velocity(&BODY, &state, v, w, NULL);
  board_count_start();
  status = status ? status : step();
  board_print_unsigned(board_count(), 8);
  board_print_unsigned(board_stack(), 7);
  board_print_unsigned((uint32_t)sizeof BODY, 8);
  board_print_unsigned((uint32_t)sizeof state, 7);
  board_print_unsigned((uint32_t)sizeof work, 7);
#ifdef DESKTOP
  printf("%8.0f", nanoseconds());
#endif
  board_print("\n");
  return status != FB_OK;
}
