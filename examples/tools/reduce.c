/* reduce - a beam or a finite-element component from a text file becomes one static const body in a C header, for ROM.
   The desktop does the model building; the target includes the header and steps.
   Exit: 0 well, 1 the model cannot be built, 2 bad options or input. */
#define FB_MAX_MODES 24
#define FB_MAX_ELEMENTS 40
#define FB_MAX_STATIONS 200
#define FB_WITH_NONLINEAR_STRAIN 0
#define FLEXBEAM_IMPLEMENTATION
#include "../../flexbeam.h"
#include "model.h"
#include "rom.h"
#include "../common/output.h"

static const char help[] =
    "reduce - a body in ROM: from a beam or component description to a C header\n"
    "usage: reduce FILE [options]\n"
    "  --out FILE   where to write the header (standard output)\n"
    "  --single     for single precision (double)\n"
    "  --name NAME  of the body (that in the file, or flexible_body)\n"
    "  --help       this text\n"
    "A summary goes to the standard error: mass, frequencies, effective mass, what the model takes.\n"
    "The descriptions are explained in examples/tools/README.md; examples/blade.txt and examples/panel.txt are "
    "two.\n";

static int fail(const char *what, const char *value)
{
  fprintf(stderr, "reduce: %s%s%s (see --help)\n", what, value[0] ? ": " : "", value);
  return 2;
}

static void summarize(const char *file)
{
  fprintf(stderr, "%s: %s, %d modes, %d nodes, mass %.6g kg\n", file, model.name, model_body.n, model_body.n_node,
          (double)model_body.mass);
  for (int k = 0; k < model_body.n; k++) {
    const double omega = sqrt((double)(model_shape.K[k * (model_body.n + 1)] / model_shape.M[k * (model_body.n + 1)]));
    fprintf(stderr, "  mode %2d  %10.5g Hz  damping %.3g\n", k + 1, omega / (2.0 * model_pi),
            (double)model.level.zeta[k]);
  }
  if (fabs((double)model.modes.spin) > 0) {
    fprintf(stderr,
            "  (Ritz modes shaped for the spin: frequencies at rest, the higher ones not those of modes at rest)\n");
  }
  if (model.kind == MODEL_COMPONENT) {
    double largest = 0;
    for (int a = 0; a < model_body.n; a++) {
      for (int b = 0; b < a; b++) {
        largest = fmax(largest, fabs((double)model_shape.M[a * model_body.n + b]));
      }
    }
    fprintf(stderr, "  modes are orthogonal against the nodes' masses to %.2g%s\n", largest,
            largest > 1e-3 ? ": masses and shapes do not quite belong together" : "");
  } else {
    fprintf(stderr, "  effective mass: x %.3f  y %.3f  z %.3f, inertia about the root: x %.3f  y %.3f  z %.3f\n",
            (double)model_modes.effective[0], (double)model_modes.effective[1], (double)model_modes.effective[2],
            (double)model_modes.effective[3], (double)model_modes.effective[4], (double)model_modes.effective[5]);
  }
  fprintf(stderr, "  %d terms of Lambda, %d of S\n", model_body.n_lambda, model_body.n_S);
}

int main(int argc, char **argv)
{
  const char *file = NULL, *to = NULL, *name = NULL, *what;
  int single = 0;
  FILE *out = stdout;
  fb_status status;
  output_begin("reduce");
  for (int i = 1; i < argc; i++) {
    if (strcmp(argv[i], "--help") == 0) {
      fputs(help, stdout);
      return 0;
    } else if (strcmp(argv[i], "--single") == 0) {
      single = 1;
    } else if (strcmp(argv[i], "--out") == 0 || strcmp(argv[i], "--name") == 0) {
      if (i + 1 == argc) {
        return fail("a value is missing", argv[i]);
      }
      *(argv[i][2] == 'o' ? &to : &name) = argv[i + 1];
      i++;
    } else if (argv[i][0] == '-' || file) {
      return fail(argv[i][0] == '-' ? "unknown option" : "one file at a time", argv[i]);
    } else {
      file = argv[i];
    }
  }
  if (!file) {
    return fail("a description is missing", "");
  }
  if (name && !model_is_name(name)) {
    return fail("not a C identifier", name);
  }
  if (!model_read("reduce", file)) {
    return 2;
  }
  if (name) {
    strcpy(model.name, name);
  }
  status = model_build(&what);
  if (status != FB_OK) {
    fprintf(stderr, "reduce: %s: %s: %s\n", file, what, fb_status_string(status));
    return 1;
  }
  summarize(file);
  if (to && !(out = fopen(to, "w"))) {
    fprintf(stderr, "reduce: %s: %s\n", to, strerror(errno));
    return 2;
  }
  rom_write(out, &model_body, model.name, file, single);
  return to ? output_close(out, to) : 0;
}
