/* import.c - integrals of a component: import FILE. Prints a line of a name and its numbers each, of modes with unit modal mass:
   mass, c (first moment), J, scale (of the shapes of the file), P, H, M, K; of second degree ups, Gam, Pi, pchi, hchi, Gamchi; reach and
   limit of deflections; r, psi, theta of nodes. */
#define FB_MAX_MODES 24
#define FB_MAX_ELEMENTS 1
#define FLEXBEAM_STATIC
#define FLEXBEAM_IMPLEMENTATION
#include "../../flexbeam.h"
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../examples/tools/model.h"

static void print(const char *name, const fb_real *value, int n)
{
  printf("%s", name);
  for (int k = 0; k < n; k++) {
    printf(" %.17g", (double)value[k]);
  }
  printf("\n");
}

int main(int argc, char **argv)
{
  const char *what = "";
  const fb_shape *const s = &model_shape;
  fb_status status;
  if (argc != 2 || !model_read("import", argv[1])) {
    return 2;
  }
  status = model_build(&what);
  if (status != FB_OK) {
    printf("%s: %s\n", what, fb_status_string(status));
    return 1;
  }
  print("mass", &s->mass, 1);
  print("c", s->c, 3);
  print("J", s->J, 9);
  print("scale", model_scale[0], s->n);
  print("P", s->P, 3 * s->n);
  print("H", s->H, 3 * s->n);
  print("M", s->M, s->n * s->n);
  print("K", s->K, s->n * s->n);
  print("ups", s->second.ups, 3 * s->n * s->n);
  print("Gam", s->second.Gam, 9 * s->n);
  print("Pi", s->second.Pi, 9 * s->n * s->n);
  print("pchi", s->second.pchi, 3 * s->n * s->n);
  print("hchi", s->second.hchi, 3 * s->n * s->n);
  print("Gamchi", s->second.Gamchi, 9 * s->n * s->n);
  print("reach", s->second.reach, s->n);
  print("limit", &model_body.deflection_limit, 1);
  for (int k = 1; k < s->n_node; k++) {
    print("r", s->node[k].r, 3);
    print("psi", s->node[k].psi, 3 * s->n);
    print("theta", s->node[k].theta, 3 * s->n);
  }
  return 0;
}
