/* sizes - bytes of the structs a program holds, for the precision and FB_MAX_MODES of this build (`make sizes`). */
#define FLEXBEAM_STATIC
#include "flexbeam.h"
#include "../examples/common/output.h"
#include <stdio.h>

int main(void)
{
  output_begin("sizes");
  printf("precision  modes    body   state  rk4_work  input    shape    modes  modes_work  join_work  body_work  "
         "build_work  system_state  system_work\n");
  printf("%-9s %6d %7d %7d %9d %6d %8d %8d %11d %10d %10d %11d %13d %12d\n", FB_SINGLE ? "single" : "double",
         FB_MAX_MODES, (int)sizeof(fb_body), (int)sizeof(fb_state), (int)sizeof(fb_rk4_work), (int)sizeof(fb_input),
         (int)sizeof(fb_shape), (int)sizeof(fb_modes), (int)sizeof(fb_modes_work), (int)sizeof(fb_join_work),
         (int)sizeof(fb_body_work), (int)sizeof(fb_build_work), (int)sizeof(fb_system_state),
         (int)sizeof(fb_system_work));
  return 0;
}
