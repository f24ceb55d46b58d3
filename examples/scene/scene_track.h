/* scene_track.h - modes over a parameter, each followed by its shape. See scene_modes.h.

   A mode a of one row and a mode b of the next are the same where their complex shapes are: MAC = |z_a* M z_b|^2 / (z_a* M z_a
   z_b* M z_b), with M of the first row, times the same of (1, lambda), which tells the two motions of an overdamped shape
   apart. Elastic coordinates of the second row, whose functions may be others, are those of the first that move the body's
   nodes as they do, by least squares. Where a mode, but of the fastest third, finds none with 0.8 of its shape, the interval is halved; where two
   seem to cross rows on both sides of that place are looked at; down to a 4096th of the interval, and a
   16,000th: modes that veer exchange their shapes step by step and do not cross; modes that cross keep them. Of modes that are equal (blades of a rotor, both
   bending planes at rest) the part of a shape in all their shapes counts, and that is what is followed. */
#ifndef SCENE_TRACK_H
#define SCENE_TRACK_H
#include "scene_modes.h"
#include <complex.h>

#define TRACK_ALIKE 0.8
#define TRACK_PARTS 4096 /* of an interval: no rows that are closer */
#define TRACK_AHEAD 32   /* rows that wait */
#define TRACK_CURVES (2 * SCENE_MODES)

typedef struct track_body { /* what its elastic coordinates do at its nodes */
  int first, n, rows;
  double *shape; /* rows x n */
} track_body;

typedef struct track_row { /* modes at a value of the parameter */
  double value, spin;      /* spin [rad/s]: of what spins fastest */
  int n, n_z, n_m, n_body; /* modes; coordinates of a shape; those of M */
  scene_mode *mode;
  double complex *lambda, *z; /* n; n x n_z */
  int *cluster, *index;       /* first mode equal to this; coordinates of M */
  double *M;                  /* n_m x n_m; NULL: diagonal, .. */
  double *weight;             /* .. of n_z */
  track_body body[FB_MAX_BODIES];
} track_row;

typedef struct track_curve {
  char name[64], (*kind)[48]; /* kind by row */
  double *damped, *growth;    /* [rad/s], [1/s] by row; NAN: it is not there */
  int mode, group, ended;     /* of the last row; group > 0: of curves that began equal, their shapes together count */
  double complex *z, lambda, slope; /* now; slope: of lambda over the parameter */
} track_curve;

typedef struct track {
  int n_row, n_curve, n_group, made, leaps; /* leaps: over which some shape changes, however short they are */
  double *value, *spin;
  track_curve curve[TRACK_CURVES];
  track_row last;
} track;

/* The modes at a value of the parameter, into row, with names if they are wanted. 0; 1: the reason is where `user` has it. */
typedef int (*track_at)(void *user, double value, int named, track_row *row);

static void track_row_free(track_row *row)
{
  for (int b = 0; b < row->n_body; b++) {
    free(row->body[b].shape);
  }
  free(row->mode);
  free(row->lambda);
  free(row->z);
  free(row->cluster);
  free(row->index);
  free(row->M);
  free(row->weight);
  memset(row, 0, sizeof *row);
}

static void track_free(track *t)
{
  track_row_free(&t->last);
  for (int k = 0; k < t->n_curve; k++) {
    free(t->curve[k].kind);
    free(t->curve[k].damped);
    free(t->curve[k].growth);
    free(t->curve[k].z);
  }
  free(t->value);
  free(t->spin);
  memset(t, 0, sizeof *t);
}

/* ---- a row */

/* M of the linear model, the inverse of dp -> dz. 0: it has none. */
static int track_mass(track_row *row, const scene *s)
{
  static fb_real W[FB_MAX_LINEAR * FB_MAX_LINEAR / 4], scale[FB_MAX_LINEAR], unit[FB_MAX_LINEAR], x[FB_MAX_LINEAR];
  static int perm[FB_MAX_LINEAR];
  const int n = scene_is_system(s) ? modal_states(s) : engine.body[0].n;
  row->n_m = n;
  for (int i = 0; i < n; i++) {
    row->index[i] = modal_coordinate(s, i);
    for (int j = 0; j < n; j++) {
      W[n * i + j] = plant.linear.A[plant.linear.n * modal_state(s, i) + modal_momentum(s, j)];
    }
  }
  if (n == 0 || fb_lu_factor(W, perm, scale, n) != FB_OK) {
    return n == 0;
  }
  for (int j = 0; j < n; j++) {
    memset(unit, 0, sizeof unit);
    unit[j] = FB_R(1.0);
    fb_lu_solve(x, W, perm, unit, n);
    for (int i = 0; i < n; i++) {
      row->M[n * i + j] += 0.5 * (double)x[i];
      row->M[n * j + i] += 0.5 * (double)x[i];
    }
  }
  return 1;
}

/* Displacements and, by the body's size, rotations of its nodes. 0: there is no memory. */
static int track_functions(track_body *to, const scene *s, int b)
{
  const fb_body *const body = &engine.body[b];
  const double length = modal_length(s);
  to->first = modal_first(s, b);
  to->n = body->n;
  to->rows = 6 * body->n_node;
  to->shape = (double *)calloc((size_t)(to->rows * to->n) + 1, sizeof *to->shape);
  for (int k = 0; k < body->n_node && to->shape; k++) {
    for (int a = 0; a < body->n; a++) {
      for (int i = 0; i < 3; i++) {
        to->shape[(6 * k + i) * body->n + a] = (double)body->node[k].psi[3 * a + i];
        to->shape[(6 * k + 3 + i) * body->n + a] = length * (double)body->node[k].theta[3 * a + i];
      }
    }
  }
  return to->shape != NULL;
}

/* Are two modes equal to rounding? */
static int track_equal(double complex a, double complex b, double fastest)
{
  return cabs(a - b) <= 1e-6 * (cabs(a) + cabs(b)) + 1e-9 * fastest;
}

/* The modes of a scene that was started. 1: the reason is in s->message. */
static int track_take(track_row *row, scene *s, double value, int named)
{
  static scene_mode mode[SCENE_MODES];
  static modal_shape z;
  const int n = (named ? scene_modes : modes_solve)(s, mode);
  int body, whole;
  memset(row, 0, sizeof *row);
  if (n < 0) {
    return 1;
  }
  row->value = value;
  row->n = n;
  row->n_z = modal_coordinates(s);
  row->n_body = s->is_exact ? 0 : s->n_body;
  row->mode = (scene_mode *)calloc((size_t)n + 1, sizeof *row->mode);
  row->lambda = (double complex *)calloc((size_t)n + 1, sizeof *row->lambda);
  row->z = (double complex *)calloc((size_t)(n * row->n_z) + 1, sizeof *row->z);
  row->cluster = (int *)calloc((size_t)n + 1, sizeof *row->cluster);
  row->index = (int *)calloc(FB_MAX_LINEAR, sizeof *row->index);
  row->M = (double *)calloc(FB_MAX_LINEAR * FB_MAX_LINEAR / 4, sizeof *row->M);
  row->weight = (double *)calloc((size_t)row->n_z + 1, sizeof *row->weight);
  whole = row->mode && row->lambda && row->z && row->cluster && row->index && row->M && row->weight;
  for (int b = 0; b < row->n_body && whole; b++) {
    whole = track_functions(&row->body[b], s, b);
  }
  if (!whole) {
    track_row_free(row);
    return scene_fail(s, "there is no memory for modes over a parameter");
  }
  copy_memory(row->mode, mode, (size_t)n * sizeof *mode);
  for (int k = 0; k < n; k++) {
    row->lambda[k] = mode[k].growth + mode[k].damped * (double complex)I;
    row->cluster[k] = k;
    for (int i = 0; i < k; i++) {
      row->cluster[k] = row->cluster[k] == k && track_equal(row->lambda[i], row->lambda[k], mode[n - 1].undamped)
                            ? row->cluster[i]
                            : row->cluster[k];
    }
    modal_take(&z, s, k);
    for (int i = 0; i < row->n_z; i++) {
      row->z[k * row->n_z + i] = z.re[i] + z.im[i] * (double complex)I;
    }
  }
  if (s->is_exact || !track_mass(row, s)) {
    free(row->M);
    row->M = NULL;
  }
  for (int i = 0; i < row->n_z; i++) {
    row->weight[i] = s->is_exact && i % 6 > 2 ? pow(MODAL_TWIST * modal_length(s), 2) : 1;
  }
  row->spin = scene_look(s, 0) == FB_OK ? scene_spin(s, &body) : 0;
  return 0;
}

/* ---- from row to row */

/* a* M b */
static double complex track_dot(const track_row *row, const double complex *a, const double complex *b)
{
  double complex sum = 0;
  for (int i = 0; i < row->n_z && !row->M; i++) {
    sum += conj(a[i]) * row->weight[i] * b[i];
  }
  for (int i = 0; i < row->n_m && row->M; i++) {
    double complex f = 0;
    for (int j = 0; j < row->n_m; j++) {
      f += row->M[row->n_m * i + j] * b[row->index[j]];
    }
    sum += conj(a[row->index[i]]) * f;
  }
  return sum;
}

/* q of one body in the functions of another: what moves the nodes alike, by least squares. */
static void track_refit(double complex *to, const double complex *from, const track_body *in, const track_body *of)
{
  fb_real G[FB_MAX_MODES * FB_MAX_MODES], scale[FB_MAX_MODES], b[2][FB_MAX_MODES], x[2][FB_MAX_MODES];
  int perm[FB_MAX_MODES];
  double trace = 0;
  memset(G, 0, sizeof G);
  memset(b, 0, sizeof b);
  for (int r = 0; r < in->rows; r++) {
    const double *const row = in->shape + r * in->n;
    double complex moved = 0;
    for (int a = 0; a < of->n; a++) {
      moved += of->shape[r * of->n + a] * from[of->first + a];
    }
    for (int i = 0; i < in->n; i++) {
      b[0][i] += (fb_real)(row[i] * creal(moved));
      b[1][i] += (fb_real)(row[i] * cimag(moved));
      trace += row[i] * row[i];
      for (int j = 0; j < in->n; j++) {
        G[in->n * i + j] += (fb_real)(row[i] * row[j]);
      }
    }
  }
  for (int i = 0; i < in->n; i++) {
    G[(in->n + 1) * i] += (fb_real)(1e-12 * trace);
  }
  if (in->n == 0 || fb_lu_factor(G, perm, scale, in->n) != FB_OK) {
    return;
  }
  for (int part = 0; part < 2; part++) {
    fb_lu_solve(x[part], G, perm, b[part], in->n);
  }
  for (int i = 0; i < in->n; i++) {
    to[in->first + i] = (double)x[0][i] + (double)x[1][i] * (double complex)I;
  }
}

/* A shape of one row in the coordinates of another. */
static void track_map(double complex *to, const double complex *from, const track_row *in, const track_row *of)
{
  const int n = in->n_z < of->n_z ? in->n_z : of->n_z;
  memset(to, 0, (size_t)in->n_z * sizeof *to);
  memcpy(to, from, (size_t)n * sizeof *to);
  for (int b = 0; b < in->n_body && b < of->n_body; b++) {
    const track_body *const one = &in->body[b], *const other = &of->body[b];
    const size_t bytes = (size_t)(one->rows * one->n) * sizeof *one->shape;
    const int same = one->n == other->n && one->first == other->first && one->rows == other->rows;
    if (one->rows == other->rows && !(same && memcmp(one->shape, other->shape, bytes) == 0)) {
      track_refit(to, from, one, other);
    }
  }
}

/* Subtracts from a shape what others have of it, from a second one the same in other coordinates, and gives them unit
   size; alike is left of a shape that has nothing of its own. */
static void track_orthogonal(const track_row *row, double complex *z, double complex *with, int n_with,
                             const double complex *const *other, const double complex *const *other_with, int n)
{
  const double before = sqrt(creal(track_dot(row, z, z)));
  double size;
  for (int k = 0; k < n; k++) {
    const double complex part = track_dot(row, other[k], z);
    for (int i = 0; i < row->n_z; i++) {
      z[i] -= part * other[k][i];
    }
    for (int i = 0; i < n_with; i++) {
      with[i] -= part * other_with[k][i];
    }
  }
  size = sqrt(creal(track_dot(row, z, z)));
  size = size > 1e-6 * before ? size : 0;
  for (int i = 0; i < row->n_z; i++) {
    z[i] = size > 0 ? z[i] / size : 0;
  }
  for (int i = 0; i < n_with; i++) {
    with[i] = size > 0 ? with[i] / size : 0;
  }
}

/* Makes the shapes of equal modes orthogonal and of unit size: z in the coordinates of `row`, `with` in those of `of`;
   NULL: none. */
static void track_separate(const track_row *row, const track_row *of, double complex *z, double complex *with)
{
  for (int b = 0; b < of->n; b++) {
    const double complex *other[SCENE_MODES], *other_with[SCENE_MODES];
    int n = 0;
    for (int c = 0; c < b; c++) {
      if (of->cluster[c] == of->cluster[b]) {
        other[n] = z + c * row->n_z;
        other_with[n++] = with ? with + c * of->n_z : NULL;
      }
    }
    track_orthogonal(row, z + b * row->n_z, with ? with + b * of->n_z : NULL, with ? of->n_z : 0, other, other_with, n);
  }
}

/* |(1, lambda_a)* (1, lambda_b)|^2 over their sizes, in units of lambda_a. */
static double track_motion(double complex a, double complex b)
{
  const double w = cabs(a);
  const double complex r = w > 0 ? b / w : 0, one = w > 0 ? a / w : 0;
  return w > 0 ? pow(cabs(1 + conj(one) * r), 2) / ((1 + pow(cabs(one), 2)) * (1 + pow(cabs(r), 2))) : 1;
}

typedef struct track_match {  /* of the curves with a row: what of the shape of curve a is in modes equal to b */
  double *alike;              /* n_curve x n */
  double complex *seen, *own; /* n modes in coordinates of the last row, and in their own */
  int mode[TRACK_CURVES];     /* -1: none */
  double least;               /* of those that are matched */
} track_match;

static void track_match_free(track_match *m)
{
  free(m->alike);
  free(m->seen);
  free(m->own);
}

/* What of curve a, or of those that began equal to it, is in mode b. */
static double track_share(const track *t, const track_row *to, const track_match *m, int a, int b)
{
  double share = 0;
  for (int k = 0; k < t->n_curve; k++) {
    const int together = k == a || (t->curve[a].group > 0 && t->curve[k].group == t->curve[a].group);
    for (int c = 0; c < to->n && together && !t->curve[k].ended; c++) {
      if (to->cluster[c] == to->cluster[b]) {
        share += pow(cabs(track_dot(&t->last, t->curve[k].z, m->seen + c * t->last.n_z)), 2);
      }
    }
  }
  return fmin(share, 1);
}

/* How much curve a goes on as mode b: by shape, and a little by where it was going; without a shape by that alone. */
static double track_score(const track *t, const track_row *to, const track_match *m, int a, int b)
{
  const track_curve *const c = &t->curve[a];
  const double complex expected = c->lambda + c->slope * (to->value - t->last.value);
  const double off = cabs(to->lambda[b] - expected) / (cabs(expected) + 1e-300);
  const double shape = m->alike[a * to->n + b];
  return (shape >= 0 ? shape : 0.5 / (1 + off)) - 0.05 * fmin(1, off);
}

/* Does mode k of n decide how long a step may be? Of the fastest third the shapes are those of what is left out. */
static int track_counts(int k, int n)
{
  return k < 6 || 3 * k < 2 * n;
}

/* The best pairs first. */
static void track_pair(track_match *m, const track *t, const track_row *to)
{
  int taken[SCENE_MODES];
  memset(taken, 0, sizeof taken);
  m->least = 1;
  for (int a = 0; a < t->n_curve; a++) {
    m->mode[a] = -1;
  }
  for (int round = 0; round < to->n; round++) {
    double best = -HUGE_VAL, shape;
    int at = -1, with = -1;
    for (int a = 0; a < t->n_curve; a++) {
      for (int b = 0; b < to->n && m->mode[a] < 0 && !t->curve[a].ended; b++) {
        const double score = taken[b] ? -HUGE_VAL : track_score(t, to, m, a, b);
        if (score > best) {
          best = score;
          at = a;
          with = b;
        }
      }
    }
    if (at < 0) {
      break;
    }
    m->mode[at] = with;
    taken[with] = 1;
    shape = m->alike[at * to->n + with];
    m->least = shape >= 0 && shape < m->least && track_counts(with, to->n) ? shape : m->least;
  }
  for (int a = 0; a < t->n_curve; a++) { /* one that oscillates does not end between rows */
    const int ends = m->mode[a] < 0 && !t->curve[a].ended && cimag(t->curve[a].lambda) > 0;
    m->least = ends && track_counts(t->curve[a].mode, t->last.n) ? 0 : m->least;
  }
}

/* Where two curves cross on the way to a row, by straight lines; NAN: none do. Over a long way they seem to where they
   veer. */
static double track_crossing(const track_match *m, const track *t, const track_row *to)
{
  for (int a = 0; a < t->n_curve; a++) {
    for (int k = 0; k < a && m->mode[a] >= 0; k++) {
      const double before = cimag(t->curve[a].lambda) - cimag(t->curve[k].lambda);
      const double after = m->mode[k] < 0 ? 0 : cimag(to->lambda[m->mode[a]]) - cimag(to->lambda[m->mode[k]]);
      const double slack = 1e-9 * fabs(cimag(t->curve[a].lambda));
      if (((before > slack && after < -slack) || (before < -slack && after > slack)) &&
          track_counts(m->mode[a], to->n) && track_counts(m->mode[k], to->n)) {
        return t->last.value + (to->value - t->last.value) * before / (before - after);
      }
    }
  }
  return (double)NAN;
}

/* Where to look between the last row and the next one; NAN: nowhere. Shapes that are not alike: in the middle; curves that
   cross: close to there on this side, then on the other. least: what is too close to be looked at. */
static double track_between(const track_match *m, const track *t, const track_row *to, double least)
{
  const double from = t->last.value, way = to->value - from, crossing = track_crossing(m, t, to);
  const double ahead = fabs(crossing - from), near = least / 16, side = way < 0 ? -near : near;
  if (fabs(way) <= (isfinite(crossing) ? 4 * near : least)) {
    return (double)NAN;
  }
  if (m->least < TRACK_ALIKE) {
    return from + 0.5 * way;
  }
  return ahead > 2 * near               ? crossing - side
         : fabs(way) - ahead > 2 * near ? crossing + side
                                        : from + 0.5 * way + 0 * crossing; /* NAN where none cross */
}

/* Matches the curves with a row. 0: there is no memory. */
static int track_compare(track_match *m, const track *t, const track_row *to)
{
  const track_row *const last = &t->last;
  memset(m, 0, sizeof *m);
  m->alike = (double *)calloc((size_t)(t->n_curve * to->n) + 1, sizeof *m->alike);
  m->seen = (double complex *)calloc((size_t)(to->n * last->n_z) + 1, sizeof *m->seen);
  m->own = (double complex *)calloc((size_t)(to->n * to->n_z) + 1, sizeof *m->own);
  if (!m->alike || !m->seen || !m->own) {
    track_match_free(m);
    return 0;
  }
  memcpy(m->own, to->z, (size_t)(to->n * to->n_z) * sizeof *m->own);
  for (int b = 0; b < to->n; b++) {
    track_map(m->seen + b * last->n_z, to->z + b * to->n_z, last, to);
  }
  track_separate(last, to, m->seen, m->own);
  for (int a = 0; a < t->n_curve; a++) {
    const double complex *const z = t->curve[a].z;
    const int shaped = creal(track_dot(last, z, z)) > 0.5;
    for (int b = 0; b < to->n && !t->curve[a].ended; b++) {
      const double complex *const seen = m->seen + b * last->n_z;
      m->alike[a * to->n + b] = shaped && creal(track_dot(last, seen, seen)) > 0.5
                                    ? track_share(t, to, m, a, b) * track_motion(t->curve[a].lambda, to->lambda[b])
                                    : -1;
    }
  }
  track_pair(m, t, to);
  return 1;
}

/* A new curve, which begins as that mode with that shape. 0: there is no memory. */
static int track_begin(track *t, const track_row *row, int mode, const double complex *z)
{
  track_curve *const c = &t->curve[t->n_curve];
  if (t->n_curve == TRACK_CURVES) {
    return 1; /* what comes and goes is left out */
  }
  memset(c, 0, sizeof *c);
  c->kind = (char(*)[48])calloc((size_t)t->n_row, sizeof *c->kind);
  c->damped = (double *)calloc((size_t)t->n_row, sizeof *c->damped);
  c->growth = (double *)calloc((size_t)t->n_row, sizeof *c->growth);
  c->z = (double complex *)calloc(MODAL_SHAPE, sizeof *c->z);
  t->n_curve++;
  if (!c->kind || !c->damped || !c->growth || !c->z) {
    return 0;
  }
  for (int k = 0; k < t->n_row; k++) {
    c->damped[k] = c->growth[k] = (double)NAN;
  }
  c->lambda = row->lambda[mode];
  c->mode = mode;
  memcpy(c->z, z, (size_t)row->n_z * sizeof *z);
  track_orthogonal(row, c->z, NULL, 0, NULL, NULL, 0);
  for (int k = 0; k < row->n && !c->group; k++) {
    c->group = k != mode && row->cluster[k] == row->cluster[mode] ? t->n_group + row->cluster[mode] : 0;
  }
  return 1;
}

/* The shape of a curve goes on: its part in the modes that are equal to the one it is. */
static void track_carry(track_curve *c, const track *t, const track_row *to, const track_match *m, int mode)
{
  double complex z[MODAL_SHAPE];
  double size;
  int equal = 0;
  memset(z, 0, sizeof z);
  for (int b = 0; b < to->n; b++) {
    if (to->cluster[b] == to->cluster[mode]) {
      const double complex part = track_dot(&t->last, m->seen + b * t->last.n_z, c->z);
      for (int i = 0; i < to->n_z; i++) {
        z[i] += part * m->own[b * to->n_z + i];
      }
      equal++;
    }
  }
  if (equal == 1 || !(cabs(track_dot(to, z, z)) > 0)) {
    memcpy(z, m->own + mode * to->n_z, (size_t)to->n_z * sizeof *z);
  }
  c->group = equal > 1 ? c->group : 0;
  size = sqrt(creal(track_dot(to, z, z)));
  for (int i = 0; i < to->n_z; i++) {
    c->z[i] = size > 0 ? z[i] / size : 0;
  }
}

/* The row becomes the last one; modes that no curve is begin one. 0: there is no memory. */
static int track_accept(track *t, track_row *to, const track_match *m)
{
  int taken[SCENE_MODES];
  const double step = to->value - t->last.value;
  const int n = t->n_curve;
  int whole = 1;
  memset(taken, 0, sizeof taken);
  for (int a = 0; a < n; a++) {
    track_curve *const c = &t->curve[a];
    const int b = m->mode[a];
    c->ended |= b < 0;
    if (!c->ended) {
      track_carry(c, t, to, m, b);
      c->slope = fabs(step) > 0 ? (to->lambda[b] - c->lambda) / step : 0;
      c->lambda = to->lambda[b];
      c->mode = b;
      taken[b] = 1 + a;
    }
  }
  track_row_free(&t->last);
  t->last = *to;
  memset(to, 0, sizeof *to);
  t->n_group += SCENE_MODES;
  for (int b = 0; b < t->last.n && whole; b++) {
    whole = taken[b] || track_begin(t, &t->last, b, m->own + b * t->last.n_z);
  }
  return whole;
}

/* Notes what the last row says. */
static void track_note(track *t)
{
  const track_row *const row = &t->last;
  t->value[t->made] = row->value;
  t->spin[t->made] = row->spin;
  for (int a = 0; a < t->n_curve; a++) {
    track_curve *const c = &t->curve[a];
    if (!c->ended) {
      c->damped[t->made] = cimag(c->lambda);
      c->growth[t->made] = creal(c->lambda);
      memcpy(c->kind[t->made], row->mode[c->mode].kind, sizeof c->kind[0]);
    }
  }
  t->made++;
}

/* The first row: each mode is a curve. 0: there is no memory. */
static int track_first(track *t, track_row *to)
{
  double complex *const z = (double complex *)calloc((size_t)(to->n * to->n_z) + 1, sizeof *z);
  int whole = z != NULL;
  t->last = *to;
  memset(to, 0, sizeof *to);
  for (int k = 0; k < t->last.n * t->last.n_z && whole; k++) {
    z[k] = t->last.z[k];
  }
  if (whole) {
    track_separate(&t->last, &t->last, z, NULL);
  }
  for (int b = 0; b < t->last.n && whole; b++) {
    whole = track_begin(t, &t->last, b, z + b * t->last.n_z);
  }
  free(z);
  return whole;
}

/* From the last row to that value, with rows between where it takes them. 1: the reason is where `user` has it; 2: there is
   no memory. */
static int track_go(track *t, track_at at, void *user, double value)
{
  track_row ahead[TRACK_AHEAD];
  const double least = fabs(value - t->last.value) / TRACK_PARTS;
  int n = 1, failed = at(user, value, 1, &ahead[0]);
  if (failed) {
    return 1;
  }
  while (n > 0 && !failed) {
    track_row *const to = &ahead[n - 1];
    track_match m;
    double between;
    failed = track_compare(&m, t, to) ? 0 : 2;
    if (failed) {
      break;
    }
    between = track_between(&m, t, to, least);
    if (isfinite(between) && n < TRACK_AHEAD && at(user, between, 0, &ahead[n]) == 0) {
      n++;
    } else {
      t->leaps += m.least < TRACK_ALIKE;
      failed = track_accept(t, to, &m) ? 0 : 2;
      n--;
    }
    track_match_free(&m);
  }
  for (int k = 0; k < n; k++) {
    track_row_free(&ahead[k]);
  }
  return failed;
}

/* ---- names */

/* The row by which curves are named: the one that spins fastest, the first of several. */
static int track_naming(const track *t)
{
  int row = 0;
  for (int k = 1; k < t->made; k++) {
    row = t->spin[k] > t->spin[row] * (1 + 1e-9) ? k : row;
  }
  return row;
}

/* Has it anything to show? Rigid motion has not. */
static int track_shows(const track *t, const track_curve *c)
{
  for (int k = 0; k < t->made; k++) {
    if (c->damped[k] > 0 || c->growth[k] > 0 || c->growth[k] < 0) {
      return 1;
    }
  }
  return 0;
}

/* The first curve that is equal to that one throughout: of blades of a rotor, of two bending planes. */
static int track_twin(const track *t, int curve_at)
{
  const track_curve *const c = &t->curve[curve_at];
  for (int a = 0; a < curve_at; a++) {
    const track_curve *const other = &t->curve[a];
    int k = 0;
    while (k < t->made && fabs(other->damped[k] - c->damped[k]) <= 1e-6 * c->damped[k] &&
           fabs(other->growth[k] - c->growth[k]) <= 1e-6 * c->damped[k]) {
      k++;
    }
    if (k == t->made) {
      return a;
    }
  }
  return curve_at;
}

/* [rad/s] Its undamped frequency at that row, or where it is not there at its first one. */
static double track_frequency(const track *t, const track_curve *c, int row)
{
  int k = c->damped[row] >= 0 ? row : 0;
  while (k + 1 < t->made && !(c->damped[k] >= 0)) {
    k++;
  }
  return hypot(c->damped[k], c->growth[k]);
}

/* The kind by which it is called. */
static const char *track_kind(const track *t, const track_curve *c, int row)
{
  const char *kind = c->kind[row];
  for (int k = 0; k < t->made && !kind[0]; k++) {
    kind = c->kind[k];
  }
  return kind[0] ? kind : "mode";
}

/* Kind and number, by frequency at that row. */
static void track_number(track *t, int row)
{
  for (int a = 0; a < t->n_curve; a++) {
    track_curve *const c = &t->curve[a];
    const char *const kind = track_kind(t, c, row);
    const double f = track_frequency(t, c, row);
    int number = 1;
    for (int k = 0; k < t->n_curve; k++) {
      const double g = track_frequency(t, &t->curve[k], row);
      const int before = g < f * (1 - 1e-6) || (k < a && g <= f * (1 + 1e-6));
      number += k != a && before && strcmp(track_kind(t, &t->curve[k], row), kind) == 0;
    }
    snprintf(c->name, sizeof c->name, "%s %d", kind, number);
  }
}

/* Curves that show something, slowest first at their first row, with names. */
static void track_finish(track *t)
{
  const int row = track_naming(t);
  int n = 0;
  for (int a = 0; a < t->n_curve; a++) {
    if (track_shows(t, &t->curve[a])) {
      const track_curve keep = t->curve[n];
      t->curve[n] = t->curve[a];
      t->curve[a] = keep;
      n++;
    }
  }
  for (int a = n; a < t->n_curve; a++) {
    free(t->curve[a].kind);
    free(t->curve[a].damped);
    free(t->curve[a].growth);
    free(t->curve[a].z);
  }
  t->n_curve = n;
  for (int a = 1; a < n; a++) { /* by insertion */
    const track_curve keep = t->curve[a];
    int k = a;
    for (; k > 0 && track_frequency(t, &t->curve[k - 1], 0) > track_frequency(t, &keep, 0) * (1 + 1e-9); k--) {
      t->curve[k] = t->curve[k - 1];
    }
    t->curve[k] = keep;
  }
  track_number(t, row);
}

/* Modes at n values from `from` to `to`. 0; 1: the reason is where `user` has it; 2: there is no memory. track_free in any
   case. */
static int track_all(track *t, track_at at, void *user, double from, double to, int n)
{
  int failed;
  memset(t, 0, sizeof *t);
  t->n_row = n;
  t->n_group = 1;
  t->value = (double *)calloc((size_t)n, sizeof *t->value);
  t->spin = (double *)calloc((size_t)n, sizeof *t->spin);
  failed = t->value && t->spin ? 0 : 2;
  for (int k = 0; k < n && !failed; k++) {
    const double value = n > 1 ? from + (to - from) * k / (n - 1) : from;
    if (k == 0) {
      track_row first;
      failed = at(user, value, 1, &first) ? 1 : track_first(t, &first) ? 0 : 2;
    } else {
      failed = track_go(t, at, user, value);
    }
    if (!failed) {
      track_note(t);
    }
  }
  if (!failed) {
    track_finish(t);
  }
  return failed;
}
#endif
