/* config.h - the smallest configuration that holds a body, for a target that has it in ROM. Include flexbeam.h
   first. */
#ifndef CONFIG_H
#define CONFIG_H
#include <stdio.h>

typedef struct config_effect { /* that a compiler flag takes out */
  unsigned effect;
  const char *name;
} config_effect;

#define CONFIG_EFFECTS 8
static const config_effect config_effects[CONFIG_EFFECTS] = {
    {FB_EFFECT_SPIN_COUPLING, "SPIN_COUPLING"},
    {FB_EFFECT_RESIDUAL_INERTIA, "RESIDUAL_INERTIA"},
    {FB_EFFECT_SPIN_STIFFENING, "SPIN_STIFFENING"},
    {FB_EFFECT_ACCELERATION_STIFFENING, "ACCELERATION_STIFFENING"},
    {FB_EFFECT_DAMPING, "DAMPING"},
    {FB_EFFECT_GRAVITY | FB_EFFECT_CENTRAL_GRAVITY, "GRAVITY"},
    {FB_EFFECT_LARGE_DEFLECTION, "LARGE_DEFLECTION"},
    {FB_EFFECT_ROTORS, "ROTORS"}};

/* Its compiler flags; between: what parts the capacities from the effects left out. */
static void config_flags(FILE *out, const fb_body *body, int single, const char *between)
{
  fprintf(out, "-DFB_SINGLE=%d -DFB_MAX_MODES=%d -DFB_MAX_NODES=%d -DFB_MAX_LAMBDA=%d -DFB_MAX_S=%d%s", single,
          body->n > 0 ? body->n : 1, body->n_node, body->n_lambda > 0 ? body->n_lambda : 1,
          body->n_S > 0 ? body->n_S : 1, between);
#if FB_WITH_LARGE_DEFLECTION
  if (body->effects & FB_EFFECT_LARGE_DEFLECTION) {
    const fb_lines *lines = &body->lines;
    fprintf(out, " -DFB_MAX_POINTS=%d -DFB_MAX_LINES=%d -DFB_MAX_LINE_ROWS=%d -DFB_MAX_LINE_TABLE=%d%s",
            lines->n_point > 2 ? lines->n_point : 2, lines->n_line > 0 ? lines->n_line : 1,
            lines->n_row > 0 ? lines->n_row : 1, lines->n_table > 0 ? lines->n_table : 1, between);
  }
#endif
#if FB_WITH_ROTORS
  if (body->n_rotor > 0) {
    fprintf(out, " -DFB_MAX_ROTORS=%d%s", body->n_rotor, between);
  }
#endif
  for (int k = 0; k < CONFIG_EFFECTS; k++) {
    if (!(body->effects & config_effects[k].effect)) {
      fprintf(out, " -DFB_WITH_%s=0", config_effects[k].name);
    }
  }
  fputs(" -DFB_WITH_NONLINEAR_STRAIN=0", out);
}
#endif
