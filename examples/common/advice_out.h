/* advice_out.h - advice as fields: members of JSON objects with the names of fb_advice. Include flexbeam.h first. */
#ifndef ADVICE_OUT_H
#define ADVICE_OUT_H
#include "linear_out.h"
#include "stepper.h"

/* Words of descriptions for the effects; the first ones by FB_ADVICE_EFFECTS. */
static const struct {
  unsigned effect;
  const char *word;
} advice_effects[] = {{FB_EFFECT_ELASTIC, "elastic"},
                      {FB_EFFECT_SPIN_COUPLING, "spin_coupling"},
                      {FB_EFFECT_RESIDUAL_INERTIA, "residual_inertia"},
                      {FB_EFFECT_SPIN_STIFFENING, "spin_stiffening"},
                      {FB_EFFECT_ACCELERATION_STIFFENING, "acceleration_stiffening"},
                      {FB_EFFECT_LARGE_DEFLECTION, "large_deflection"},
                      {FB_EFFECT_DAMPING, "damping"},
                      {FB_EFFECT_GRAVITY, "gravity"}};

/* Units of the members, once a file. */
static inline void advice_put_units(FILE *file)
{
  fputs("  \"units\": {\"tolerance\": \"1\", \"step\": \"s\", \"cost\": \"instructions/s\", \"deflection\": \"m\", "
        "\"error\": \"1\", "
        "\"without\": \"1\"},\n",
        file);
}

static inline void advice_put(FILE *file, const char *key, double x)
{
  fprintf(file, "\"%s\": ", key);
  if (x - x < 0 || x - x > 0 || x != x || x > 1e300) { /* JSON has no such number */
    fputs("null", file);
  } else {
    linear_put(file, x);
  }
}

/* Members of the advice for a tolerance, of `all` modes; errors and tolerance relative to the deflection. */
static inline void advice_put_json(FILE *file, const fb_advice *a, int all, double tolerance)
{
  static const char *const error[] = {"all", "effects", "modes", "step", "model", "field"};
  const fb_real value[] = {a->error, a->error_effects, a->error_modes, a->error_step, a->error_model, a->error_field};
  const char *comma = "";
  advice_put(file, "tolerance", tolerance);
  fputs(", \"effects\": [", file);
  for (size_t k = 0; k < sizeof advice_effects / sizeof *advice_effects; k++) {
    if (a->effects & advice_effects[k].effect) {
      fprintf(file, "%s\"%s\"", comma, advice_effects[k].word);
      comma = ", ";
    }
  }
  fputs("], \"modes\": [", file);
  for (int k = 0; k < a->n; k++) {
    fprintf(file, k ? ", %d" : "%d", a->coordinate[k]);
  }
  fprintf(file, "], \"modes_there\": %d, \"integrator\": \"%s\", ", all, stepper_name[a->integrator]);
  advice_put(file, "step", (double)a->dt);
  fprintf(file, ", \"long_step\": %s, \"line_points\": %d, ", a->long_step ? "true" : "false", a->line_points);
  advice_put(file, "cost", (double)a->cost);
  fputs(", ", file);
  advice_put(file, "deflection", (double)a->deflection);
  fputs(", \"error\": {", file);
  for (size_t k = 0; k < sizeof value / sizeof *value; k++) {
    fputs(k ? ", " : "", file);
    advice_put(file, error[k], (double)value[k]);
  }
  fputs("}, \"without\": {", file);
  for (int k = 1; k < FB_ADVICE_EFFECTS; k++) {
    fputs(k > 1 ? ", " : "", file);
    advice_put(file, advice_effects[k].word, (double)a->without[k]);
  }
  fputs("}", file);
}
#endif
