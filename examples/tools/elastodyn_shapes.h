/* elastodyn_shapes.h - mode shapes of a described blade or tower as ElastoDyn's files have them: polynomials of degree 2 to 6
   in the fraction of the length, 1 at the tip. Include model.h first. */
#ifndef ELASTODYN_SHAPES_H
#define ELASTODYN_SHAPES_H

enum { SHAPE_LOW = 2, SHAPE_TERMS = 5, SHAPE_FREE = SHAPE_TERMS - 1 };

/* ElastoDyn integrates the curvature of a mode, which is about the principal axes of the twisted section, and turns it by the
   twist on the way: its shape is what the beam would deflect without twist, from these curvatures. phi: at the nodes. */
static void shape_untwisted(double *phi, int mode, fb_kind kind)
{
  const fb_beam *const beam = &model_beam[0];
  const int n = beam->desc.n_element;
  double slope = 0;
  phi[0] = 0;
  for (int k = 0; k < n; k++) {
    const fb_real *const a = &model_modes[0].shape[mode * model_modes[0].ndof + 6 * k], *const b = a + 6;
    const double h = (double)(beam->start[k + 1] - beam->start[k]);
    const double bow[2] = {(double)(b[1] - a[1]) - h * (double)a[5], (double)(b[2] - a[2]) + h * (double)a[4]};
    const double turn[2] = {(double)(b[5] - a[5]), -(double)(b[4] - a[4])}; /* u_y', u_z' */
    double c, s;
    fb_section section;
    fb_beam_section_eval(beam, &section, FB_R(0.5) * (beam->start[k] + beam->start[k + 1]));
    c = cos((double)section.twist);
    s = kind == FB_KIND_BEND_Z ? -sin((double)section.twist) : sin((double)section.twist);
    phi[k + 1] = phi[k] + h * slope + (kind == FB_KIND_BEND_Z ? c * bow[1] + s * bow[0] : c * bow[0] + s * bow[1]);
    slope += kind == FB_KIND_BEND_Z ? c * turn[1] + s * turn[0] : c * turn[0] + s * turn[1];
  }
}

/* Least squares over the nodes of x^6 + sum c_k (x^k - x^6), k = 2..5, so that the sum of all is 1. The largest misfit, of the
   largest value; below 0: the modes do not reach the tip. */
static double shape_fit(double coefficient[SHAPE_TERMS], const double *phi)
{
  const fb_beam *const beam = &model_beam[0];
  const int n = beam->desc.n_element;
  fb_real A[SHAPE_FREE * SHAPE_FREE] = {0}, b[SHAPE_FREE] = {0}, y[SHAPE_FREE];
  int perm[SHAPE_FREE];
  double misfit = 0, largest = 0;
  for (int k = 1; k <= n; k++) {
    const double x = (double)(beam->start[k] / beam->start[n]), rest = phi[k] / phi[n] - pow(x, 6);
    for (int i = 0; i < SHAPE_FREE; i++) {
      const double f = pow(x, SHAPE_LOW + i) - pow(x, 6);
      b[i] += (fb_real)(f * rest);
      for (int j = 0; j < SHAPE_FREE; j++) {
        A[SHAPE_FREE * i + j] += (fb_real)(f * (pow(x, SHAPE_LOW + j) - pow(x, 6)));
      }
    }
  }
  if (fb_lu_factor(A, perm, y, SHAPE_FREE) != FB_OK) {
    return -1;
  }
  fb_lu_solve(y, A, perm, b, SHAPE_FREE);
  coefficient[SHAPE_FREE] = 1;
  for (int i = 0; i < SHAPE_FREE; i++) {
    coefficient[i] = (double)y[i];
    coefficient[SHAPE_FREE] -= coefficient[i];
  }
  for (int k = 1; k <= n; k++) {
    const double x = (double)(beam->start[k] / beam->start[n]);
    double value = 0;
    for (int i = 0; i < SHAPE_TERMS; i++) {
      value += coefficient[i] * pow(x, SHAPE_LOW + i);
    }
    misfit = fmax(misfit, fabs(value - phi[k] / phi[n]));
    largest = fmax(largest, fabs(phi[k] / phi[n]));
  }
  return misfit / largest;
}

typedef struct shape_line {
  const char *key, *text, *word;
  fb_kind kind;
  int which; /* of its kind, from 0 */
} shape_line;

static const shape_line blade_shapes[] = {{"BldFl1Sh", "Flap mode 1", "bend_z", FB_KIND_BEND_Z, 0},
                                          {"BldFl2Sh", "Flap mode 2", "bend_z", FB_KIND_BEND_Z, 1},
                                          {"BldEdgSh", "Edge mode 1", "bend_y", FB_KIND_BEND_Y, 0},
                                          {NULL, NULL, NULL, FB_KIND_COUNT, 0}};
static const shape_line tower_shapes[] = {{"TwFAM1Sh", "Fore-aft mode 1", "bend_z", FB_KIND_BEND_Z, 0},
                                          {"TwFAM2Sh", "Fore-aft mode 2", "bend_z", FB_KIND_BEND_Z, 1},
                                          {"TwSSM1Sh", "Side-to-side mode 1", "bend_y", FB_KIND_BEND_Y, 0},
                                          {"TwSSM2Sh", "Side-to-side mode 2", "bend_y", FB_KIND_BEND_Y, 1},
                                          {NULL, NULL, NULL, FB_KIND_COUNT, 0}};

static int shape_find(const shape_line *s)
{
  int left = s->which;
  for (int k = 0; k < model_modes[0].n; k++) {
    if (model_modes[0].kind[k] == s->kind && left-- == 0) {
      return k;
    }
  }
  return -1;
}

/* Why this description has no such shapes; NULL: it has. */
static const char *shape_refusal(void)
{
  const model_part *const part = &model.part[0];
  return model.n_part != 1 || part->kind != MODEL_BEAM ? "it is not one beam"
         : part->beam.root != FB_ROOT_CLAMPED          ? "its root is not clamped"
         : part->beam.n_point > 0                      ? "its line is not straight: ElastoDyn's is"
         : model_modes[0].degree > 0                   ? "it has element functions, not modes"
         : part->beam.n_element < 8 ? "it has less than 8 elements, from whose nodes polynomials are fitted"
                                    : NULL;
}

/* The lines of a blade or tower file, of modes at a spin [rad/s] whose axis is radius [m] from the root; a status of main. */
static int write_shapes(const char *file, const shape_line *list, double spin, double radius)
{
  const char *what, *wrong;
  fb_status status;
  if (!model_read(PROGRAM, file)) {
    return 2;
  }
  model.level.base = FB_BASE_PRESCRIBED; // modes alone are wanted, of beams without inertia about x, too
  if (spin > 0) {
    model.part[0].modes.spin = 0; // modes at the spin, not those at rest that are chosen for it
    model.part[0].modes.preload.spin = (fb_real)spin;
    model.part[0].modes.preload.spin_radius = (fb_real)radius;
  }
  status = model_build(&what);
  if (status != FB_OK) {
    fprintf(stderr, PROGRAM ": %s: %s: %s\n", file, what, fb_status_string(status));
    return 2;
  }
  wrong = shape_refusal();
  if (wrong) {
    fprintf(stderr, PROGRAM ": %s: no mode shapes of ElastoDyn: %s\n", file, wrong);
    return 2;
  }
  for (const shape_line *s = list; s->key; s++) {
    double phi[FB_MAX_ELEMENTS + 1], coefficient[SHAPE_TERMS], misfit;
    const int mode = shape_find(s);
    if (mode < 0) {
      fprintf(stderr, PROGRAM ": %s: there is no %s: modes bend_y 2 bend_z 2 or more are wanted\n", file, s->text);
      return 2;
    }
    shape_untwisted(phi, mode, s->kind);
    misfit = shape_fit(coefficient, phi);
    for (int i = 0; i < SHAPE_TERMS; i++) {
      printf("%16.9f   %s(%d) - %s, coefficient of x^%d\n", coefficient[i], s->key, SHAPE_LOW + i, s->text,
             SHAPE_LOW + i);
    }
    fprintf(stderr, "%s: %s, %.5g Hz, polynomial within %.2g %% of the shape\n", s->key, s->text,
            (double)model_modes[0].omega[mode] / (2 * model_pi), 100 * misfit);
  }
  return 0;
}
#endif
