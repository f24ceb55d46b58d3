/* first_curve.c - the tip of a rotor blade over time, by the shared library. From the top:
   cc -Iexamples/bindings examples/bindings/first_curve.c -Lbuild/bindings -lflexbeam_scene -o build/first_curve */
#include "flexbeam_scene.h"
#include <stdio.h>

int main(void)
{
  fbs *const rotor = fbs_new();
  int status = rotor ? fbs_open(rotor, "examples/scenes/rotor.txt", NULL, 0, NULL, NULL) : FBS_ERROR;
  const int tip = status == FBS_OK ? fbs_find(rotor, FBS_OUTPUTS, "tip_1") : 0;
  for (int k = 0; k <= 5 && status == FBS_OK; k++) {
    double z = 0;
    status = fbs_step_to(rotor, 0.5 * k);
    status = status ? status : fbs_get(rotor, FBS_OUTPUTS, 1, &tip, &z);
    printf("%.1f s: %.12g m\n", fbs_time(rotor), z);
  }
  fputs(status == FBS_OK ? "" : rotor ? fbs_error(rotor) : "no memory", stderr);
  fbs_free(rotor);
  return fflush(stdout) == 0 && status == FBS_OK ? 0 : 1;
}
