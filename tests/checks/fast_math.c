/* fast_math - what a build with the flags of fast_math.sh does: prints "exact" when fb_build_check and every _init take
   it, "refused" when all refuse it, and fails where they differ. */
#define FLEXBEAM_STATIC
#include "flexbeam.h"
#include <stdio.h>

static fb_beam beam;
static fb_beam_desc beam_desc;
static fb_shape shape;
static fb_body body;
static fb_body_work work;
static fb_body_desc body_desc;
static fb_state state;
static fb_system a_system;
static fb_system_desc system_desc;
static fb_system_work system_work;
static fb_system_state system_state;
static fb_exact exact;
static fb_exact_desc exact_desc;
static fb_exact_state exact_state;
static fb_exact_work exact_work;
static fb_exponential exponential;

int main(void)
{
  /* All but the second have nothing to go by: they refuse that, too, but for another reason. */
  const fb_status of[] = {fb_build_check(),
                          fb_shape_init(&shape, 0),
                          fb_state_init(&body, &state),
                          fb_beam_init(&beam, &beam_desc),
                          fb_body_init(&body, &work, &shape, &body_desc),
                          fb_system_init(&a_system, &system_work, &body, &system_desc, 1),
                          fb_system_state_init(&a_system, &body, &system_state, &system_work, NULL, NULL),
                          fb_exact_init(&exact, &exact_desc),
                          fb_exact_state_init(&exact, &exact_state, &exact_work, NULL),
                          fb_exponential_init(&exponential, &work, &body, FB_R(0.0))};
  int refused = 0;
  for (int k = 0; k < (int)(sizeof of / sizeof of[0]); k++) {
    refused += of[k] == FB_ERR_BUILD;
  }
  if (refused != 0 && refused != (int)(sizeof of / sizeof of[0])) {
    printf("%d of the functions refuse\n", refused);
    return 1;
  }
  puts(refused ? "refused" : "exact");
  return fflush(stdout) == 0 ? 0 : 1;
}
