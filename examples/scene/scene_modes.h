/* scene_modes.h - the modes of a scene about its start, slowest first: frequency, damping, and what moves. See scene.h.

   What moves: coordinates (axes of joints, modes of bodies) by their share of the kinetic energy, |lambda z_i|^2 / (2 m_i)
   with the mobility m_i, the diagonal of M^-1, which dp -> dz of the linear model has; couplings are left out, and shares
   below a tenth. Of an exact beam: the node that moves most, and along or about which of its axes. */
#ifndef SCENE_MODES_H
#define SCENE_MODES_H
#include "scene_linear.h"
#include "../common/spectrum.h"

#define MODES_OF_BEAM 12
#define MODES_NAMED 4 /* coordinates of a mode that are named */

/* Writes the coordinates that have the largest shares of the kinetic energy of mode k, largest first. */
static void modes_name(char *text, size_t size, const scene *s, int k)
{
  const fb_linear *const l = &plant.linear;
  const int half = scene_is_system(s) ? (l->n - l->n_rotor) / 2 : engine.body[0].n;
  int total = half, at = 0;
  double share[FB_MAX_LINEAR], sum = 0;
  if (scene_is_system(s)) {
    total = plant_axes_before(s, s->n_body);
    for (int b = 0; b < s->n_body; b++) {
      total += engine.body[b].n;
    }
  }
  for (int i = 0; i < half; i++) {
    const int z = k * total + (scene_is_system(s) ? l->coordinate[i] : i);
    const double mobility = fabs((double)l->A[i * l->n + half + i]);
    const double size_z = hypot((double)engine.spectrum.shape_re[z], (double)engine.spectrum.shape_im[z]);
    share[i] = mobility > 0 ? size_z * size_z / mobility : 0;
    sum += share[i];
  }
  snprintf(text, size, "%s", sum > 0 ? "" : "rigid-body motion or rotors");
  for (int n = 0; n < MODES_NAMED && sum > 0; n++) {
    int most = 0;
    for (int i = 1; i < half; i++) {
      most = share[i] > share[most] ? i : most;
    }
    if (share[most] < 0.1 * sum) {
      break;
    }
    at += snprintf(text + at, size - (size_t)at, "%s%s %.0f %%", n ? ", " : "", plant.file.state[most].name,
                   100 * share[most] / sum);
    share[most] = 0;
    if ((size_t)at >= size) {
      break;
    }
  }
}

/* Writes the node of the exact beam whose displacement, or twist times a tenth of the length, is largest in mode k. */
static void modes_name_exact(char *text, size_t size, const scene *s, int k)
{
  static const char *const axes[] = {"along x", "along y", "along z", "about x"};
  const int n = 6 * (exact_run.beam.n + 1);
  const double length = (double)exact_run.beam.length;
  double most = -1;
  int at = 0;
  for (int i = 0; i < n; i++) {
    const double weight = i % 6 < 3 ? 1 : i % 6 == 3 ? 0.1 * length : 0;
    const double part =
        weight * hypot((double)exact_run.spectrum.shape_re[k * n + i], (double)exact_run.spectrum.shape_im[k * n + i]);
    at = part > most * (1 + 1e-6) ? i : at;
    most = fmax(most, part);
  }
  snprintf(text, size, "%s: node %d of %d %s", s->body[0].name, at / 6, exact_run.beam.n, axes[at % 6]);
}

/* The slowest modes of an exact beam, as many as it has and as converge. */
static fb_status modes_of_beam(const scene *s)
{
  fb_status status = FB_ERR_MODES;
  for (int count = MODES_OF_BEAM; count > 0 && (status == FB_ERR_MODES || status == FB_ERR_CONVERGENCE); count--) {
    status = exact_spectrum(s, count);
  }
  return status;
}

typedef struct scene_mode {
  double undamped, damped, ratio, growth; /* [rad/s], [rad/s], -, [1/s] */
  char what[256];                         /* moves */
} scene_mode;
#define SCENE_MODES (FB_MAX_LINEAR > MODES_OF_BEAM ? FB_MAX_LINEAR : MODES_OF_BEAM)

/* The modes about the start, slowest first: how many; -1: the reason is in s->message. */
static int scene_modes(scene *s, scene_mode mode[SCENE_MODES])
{
  fb_real *const re = s->is_exact ? exact_run.spectrum.re : engine.spectrum.re;
  fb_real *const im = s->is_exact ? exact_run.spectrum.im : engine.spectrum.im;
  fb_status status = plant_begin(s);
  int n;
  status = status ? status : s->is_exact ? modes_of_beam(s) : plant_solve(s);
  status = status || s->is_exact ? status : scene_spectrum(s);
  if (status != FB_OK) {
    (void)scene_fail(s, "no modes about the start: %s", refusal_text(status));
    return -1;
  }
  if (!s->is_exact) {
    plant_describe(s);
  }
  n = s->is_exact ? exact_run.spectrum.n : engine.spectrum.n;
  n = s->is_exact && n > MODES_OF_BEAM ? MODES_OF_BEAM : n; /* a pair of equal ones ends beyond */
  (void)spectrum_drop_rounding(re, im, n);
  for (int k = 0; k < n; k++) {
    const double size = hypot((double)re[k], (double)im[k]), omega = fabs((double)im[k]);
    const double error = s->is_exact ? (double)exact_run.spectrum.error[k] * size : (double)engine.spectrum.error[k];
    const double growth = fabs((double)re[k]) > error ? (double)re[k] : 0;
    const scene_mode one = {size, omega, size > 0 ? -growth / size + 0.0 : 0, growth + 0.0, "rigid-body motion"};
    mode[k] = one;
    if (size > 0) {
      (s->is_exact ? modes_name_exact : modes_name)(mode[k].what, sizeof mode[k].what, s, k);
    }
  }
  return n;
}

/* Prints a row for each. 1: the reason is in s->message. */
static int scene_print_modes(scene *s, FILE *out)
{
  static const double pi = 3.14159265358979323846;
  static scene_mode mode[SCENE_MODES];
  const int n = scene_modes(s, mode);
  if (n < 0) {
    return 1;
  }
  fprintf(out, "mode  undamped [Hz]  damped [Hz]  damped [rad/s]  damping ratio  growth [1/s]  what moves\n");
  for (int k = 0; k < n; k++) {
    const scene_mode *const m = &mode[k];
    fprintf(out, "%4d  %13.6g  %11.6g  %14.6g  %13.4g  %12.4g  %s\n", k + 1, m->undamped / (2 * pi),
            m->damped / (2 * pi), m->damped, m->ratio, m->growth, m->what);
  }
  return 0;
}
#endif
