/* scene_modes.h - the modes of a scene about its start, slowest first: frequency, damping, what moves, a name, their
   motion as an animation. See scene.h.

   What moves: joints (by axis) and the bending of bodies, by their share of the kinetic energy, |lambda z_i|^2 / (2 m_i)
   with the mobility m_i, the diagonal of M^-1, which dp -> dz of the linear model has; couplings are left out, and shares
   below a tenth. Of an exact beam: the node that moves most, and along or about which of its axes.

   Names: of the body that has most of it, at its point that moves most. Of what spins: flap along the axis of the spin,
   lag across that and the line of the body, axial along the line, torsion about it. Of what stands still beside something
   that spins: fore-aft along that axis, side-side across. Elsewhere: bend_y, bend_z by the axes of the body. A body
   without a line has the name of its joint. */
#ifndef SCENE_MODES_H
#define SCENE_MODES_H
#include "scene_shapes.h"
#include "scene_draw.h"
#include "../common/spectrum.h"

#define MODES_OF_BEAM 12
#define MODAL_TWIST 0.1 /* of the length: a turn about the line counts as a displacement of so much */
#define SCENE_MODES (FB_MAX_LINEAR > MODES_OF_BEAM ? FB_MAX_LINEAR : MODES_OF_BEAM)

typedef struct scene_mode {
  double undamped, damped, ratio, growth; /* [rad/s], [rad/s], -, [1/s] */
  char kind[48];                          /* flap, or blade flap; empty: it has none */
  char name[64];                          /* kind and its number among those of that kind: flap 2 */
  char what[256];                         /* moves */
  char part[TEXT_NAME];                   /* joint or body with the largest share */
} scene_mode;

/* ---- names */

typedef struct modal_part { /* of the kinetic energy: an axis of a joint, or the bending of a body */
  char name[TEXT_NAME + 8];
  int body;            /* that bends, or that the joint carries */
  double share, most;  /* of the whole; of the coordinate that has most, .. */
  char coordinate[16]; /* .. and which it is: q3 */
} modal_part;

/* The body that state i belongs to. */
static int modal_body(const scene *s, int i)
{
  int axis[6], at = modal_coordinate(s, i), b = 0;
  if (!scene_is_system(s)) {
    return 0;
  }
  for (; b < s->n_body; b++) {
    const int n = linear_free_axes(axis, &engine.system, &engine.system_state, b);
    if (at < n) {
      return b;
    }
    at -= n;
  }
  for (b = 0; b + 1 < s->n_body && at >= engine.body[b].n; b++) {
    at -= engine.body[b].n;
  }
  return b;
}

/* Parts by their share of the kinetic energy of a shape, largest first: how many. What floats has no share: what moves
   against it tells, unless nearly all of it floats (nutation). */
static int modal_parts(modal_part *part, const scene *s, const modal_shape *z)
{
  const int one = !scene_is_system(s), half = one ? engine.body[0].n : modal_states(s);
  double sum = 0, floating = 0;
  int n = 0;
  for (int i = 0; i < half; i++) {
    const int c = modal_coordinate(s, i), b = modal_body(s, i);
    const double mobility = fabs((double)plant.linear.A[i * plant.linear.n + modal_momentum(s, i)]);
    const double size = hypot(z->re[c], z->im[c]), share = mobility > 0 ? size * size / mobility : 0;
    const char *const name = plant.file.state[i].name, *const dot = strrchr(name, '.');
    const int bends = c >= modal_first(s, 0), length = bends && dot ? (int)(dot - name) : (int)strlen(name);
    int at = 0;
    if (!one && !bends && engine.system.joint[b].kind == FB_JOINT_FREE && !engine.system.joint[b].moored) {
      floating += share;
      continue;
    }
    while (at < n && (strlen(part[at].name) != (size_t)length || strncmp(part[at].name, name, (size_t)length) != 0)) {
      at++;
    }
    if (at == n) {
      memset(&part[n], 0, sizeof part[n]);
      snprintf(part[n].name, sizeof part[n].name, "%.*s", length, name);
      part[n++].body = b;
    }
    part[at].share += share;
    if (share > part[at].most && bends && !one) {
      part[at].most = share;
      snprintf(part[at].coordinate, sizeof part[at].coordinate, "%.15s", dot ? dot + 1 : name);
    }
    sum += share;
  }
  for (int i = 0; i < n; i++) {
    int most = i;
    for (int k = i + 1; k < n; k++) {
      most = part[k].share > part[most].share ? k : most;
    }
    if (most != i) {
      const modal_part keep = part[i];
      part[i] = part[most];
      part[most] = keep;
    }
    part[i].share = sum > 0 ? part[i].share / sum : 0;
  }
  return sum > 0.01 * floating ? n : 0;
}

/* "flap.1 97 %, blade 3 % (q1)" */
static void modal_tell(char *text, size_t size, const modal_part *part, int n)
{
  size_t at = 0;
  snprintf(text, size, "%s", n > 0 ? "" : "rigid-body motion or rotors");
  for (int k = 0; k < n && part[k].share >= 0.1 && at < size; k++) {
    const char *const q = part[k].coordinate;
    at += (size_t)snprintf(text + at, size - at, "%s%s %.0f %%%s%s%s", k ? ", " : "", part[k].name, 100 * part[k].share,
                           q[0] ? " (" : "", q, q[0] ? ")" : "");
  }
}

/* The node of the exact beam whose displacement, or twist times a tenth of the length, is largest. */
static void modal_tell_exact(char *text, size_t size, const scene *s, const modal_shape *z)
{
  static const char *const axes[] = {"along x", "along y", "along z", "about x"};
  double most = -1;
  int at = 0;
  for (int i = 0; i < modal_coordinates(s); i++) {
    const double weight = i % 6 < 3 ? 1 : i % 6 == 3 ? 0.1 * (double)exact_run.beam.length : 0;
    const double part = weight * hypot(z->re[i], z->im[i]);
    at = part > most * (1 + 1e-6) ? i : at;
    most = fmax(most, part);
  }
  snprintf(text, size, "%s: node %d of %d %s", s->body[0].name, at / 6, exact_run.beam.n, axes[at % 6]);
}

/* Size of a complex vector along a unit vector. */
static double modal_along(double x[2][3], const double along[3])
{
  return hypot(modal_dot(x[0], along), modal_dot(x[1], along));
}

/* Of a rigid body that spins: the direction from the axis to its center of mass, by its velocity w x r. */
static void modal_radial(double line[3], int b, const double w[3])
{
  fb_real R[9], v[3], across[3], along[3];
  const fb_motion *const m = &engine.view.motion.motion[b];
  double inertial[3];
  fb_vec3_cross(across, m->w, engine.body[b].c);
  for (int i = 0; i < 3; i++) {
    v[i] = m->v[i] + across[i] / engine.body[b].mass;
  }
  fb_quat_to_mat33(R, engine.view.motion.pose[b].quat);
  fb_mat33_mul_vec3(along, R, v);
  for (int i = 0; i < 3; i++) {
    inertial[i] = (double)along[i];
  }
  modal_cross(line, inertial, w);
  modal_unit(line);
}

/* The point that moves most, among those with a line where the body has one; -1: there is none. */
static int modal_farthest(modal_point *point, int n, double length, int lined)
{
  double most = -1;
  int at = -1;
  for (int k = 0; k < n; k++) {
    const double moved = modal_dot(point[k].u[0], point[k].u[0]) + modal_dot(point[k].u[1], point[k].u[1]);
    const double turned = modal_along(point[k].turn, point[k].line) * MODAL_TWIST * length;
    if ((!lined || modal_dot(point[k].line, point[k].line) > 0) && moved + turned * turned > most * (1 + 1e-9)) {
      most = moved + turned * turned;
      at = k;
    }
  }
  return at;
}

typedef struct modal_frame { /* what a motion is named by */
  double spin[3], beside[3]; /* of the body; of the fastest of all */
  double length;
  fb_real axes[9]; /* of the body; all inertial */
} modal_frame;

/* Directions across a line, and how motion is called along it, along them and about it. */
static const char *const *modal_words(double first[3], double second[3], const modal_frame *f, const double line[3])
{
  static const char *const spun[] = {"axial", "flap", "lag", "torsion"},
                           *const beside[] = {"axial", "fore-aft", "side-side", "torsion"},
                           *const still[] = {"axial", "bend_y", "bend_z", "torsion"},
                           *const shaft[] = {"axial", "bending", "bending", "torsion"};
  const int spins = modal_dot(f->spin, f->spin) > 0;
  const double *const axis = spins ? f->spin : f->beside;
  const double y[3] = {(double)f->axes[1], (double)f->axes[4], (double)f->axes[7]}, size = modal_dot(axis, axis);
  const double along = fabs(modal_dot(y, line)) > 0.9; /* a line along y */
  modal_cross(second, axis, line);
  if (size > 0 && modal_dot(second, second) > 0.04 * size) {
    modal_unit(second);
    modal_cross(first, line, second);
    return spins ? spun : beside;
  }
  for (int i = 0; i < 3; i++) {
    second[i] = (double)f->axes[along > 0 ? 3 * i : 3 * i + 2]; /* x or z */
  }
  modal_cross(first, second, line);
  modal_unit(first);
  modal_cross(second, line, first);
  return size > 0 || along > 0 ? shaft : still;
}

/* What a point of a body with a line does. */
static const char *modal_kind_of(modal_point *p, const modal_frame *f)
{
  double first[3], second[3], size[4];
  const char *const *const word = modal_words(first, second, f, p->line);
  int kind = 0;
  size[0] = modal_along(p->u, p->line);
  size[1] = modal_along(p->u, first);
  size[2] = modal_along(p->u, second);
  size[3] = modal_along(p->turn, p->line) * MODAL_TWIST * f->length;
  for (int k = 1; k < 4; k++) {
    kind = size[k] > size[kind] * (1 + 1e-6) ? k : kind;
  }
  return word[kind];
}

/* Does the ground hold body b through that one? */
static int modal_hangs(const scene *s, int b, int on)
{
  for (int hop = 0; hop < s->n_body && b >= 0 && b != on; hop++) {
    b = engine.system.joint[b].parent;
  }
  return b == on;
}

/* The body that has most of the motion: that which bends, or what moves most with the joint, by mass and mean square. */
static int modal_mover(modal_point *point, int *n, const scene *s, const modal_shape *z, const modal_part *part)
{
  int mover = part->body;
  double most = 0;
  for (int b = 0; b < s->n_body && scene_is_system(s) && !part->coordinate[0]; b++) {
    double moved = 0;
    if (modal_hangs(s, b, part->body)) {
      *n = modal_points(point, s, z, b);
      for (int k = 0; k < *n; k++) {
        moved += modal_dot(point[k].u[0], point[k].u[0]) + modal_dot(point[k].u[1], point[k].u[1]);
      }
      moved *= *n > 0 ? (double)engine.body[b].mass / *n : 0;
    }
    if (moved > most * (1 + 1e-6)) {
      most = moved;
      mover = b;
    }
  }
  *n = modal_points(point, s, z, mover);
  return mover;
}

/* Does a kind want the name of its body: are there other bodies with lines, none of which is like it, as blades are? */
static int modal_wants_name(const scene *s, int b)
{
  int others = 0;
  for (int k = 0; k < s->n_body; k++) {
    const fb_body *const one = &engine.body[b], *const other = &engine.body[k];
    others += k != b && s->body[k].n_drawn > 1;
    if (k != b && one->n == other->n && one->n_node == other->n_node && !(FB_FABS(one->mass - other->mass) > 0)) {
      return 0;
    }
  }
  return others > 0;
}

/* What the part of a shape with most of its energy does, into kind. part NULL: of an exact beam. */
static void modal_name(char kind[48], const scene *s, const modal_shape *z, const modal_part *part)
{
  static modal_point point[FB_MAX_EXACT + 1 > FB_MAX_NODES ? FB_MAX_EXACT + 1 : FB_MAX_NODES];
  int n = part ? 0 : modal_points_exact(point, z), fastest, at;
  const int b = part ? modal_mover(point, &n, s, z, part) : 0, lined = !part || s->body[b].n_drawn > 1;
  const char *name;
  modal_frame f;
  if (n == 0 || scene_look(s, 0) != FB_OK) {
    return;
  }
  (void)scene_spin(s, &fastest);
  (void)modal_spin(f.beside, s, fastest);
  (void)modal_spin(f.spin, s, b);
  f.length = modal_length(s);
  fb_quat_to_mat33(f.axes, engine.view.motion.pose[b].quat);
  for (int k = 0; k < n && !lined && modal_dot(f.spin, f.spin) > 0; k++) {
    modal_radial(point[k].line, b, f.spin);
  }
  at = modal_farthest(point, n, f.length, lined);
  name = at >= 0 && modal_dot(point[at].line, point[at].line) > 0 ? modal_kind_of(&point[at], &f) : NULL;
  if (name && modal_wants_name(s, b)) {
    snprintf(kind, 48, "%.30s %s", s->body[b].name, name);
  } else if (name) {
    snprintf(kind, 48, "%s", name);
  } else {
    snprintf(kind, 48, "%.40s", part ? part->name : "");
  }
}

/* ---- all of them */

/* The slowest modes of an exact beam, as many as it has and as converge. */
static fb_status modes_of_beam(const scene *s)
{
  fb_status status = FB_ERR_MODES;
  for (int count = MODES_OF_BEAM; count > 0 && (status == FB_ERR_MODES || status == FB_ERR_CONVERGENCE); count--) {
    status = exact_spectrum(s, count);
  }
  return status;
}

/* What moves in mode k, and how it is called. */
static void mode_describe(scene_mode *mode, const scene *s, int k)
{
  static modal_part part[FB_MAX_LINEAR];
  static modal_shape z;
  int n;
  modal_take(&z, s, k);
  if (s->is_exact) {
    modal_tell_exact(mode->what, sizeof mode->what, s, &z);
    snprintf(mode->part, sizeof mode->part, "%s", s->body[0].name);
    modal_name(mode->kind, s, &z, NULL);
    return;
  }
  n = modal_parts(part, s, &z);
  modal_tell(mode->what, sizeof mode->what, part, n);
  if (n > 0) {
    const int whole = scene_is_system(s) ? (int)strcspn(part[0].name, ".") : 0;
    snprintf(mode->part, sizeof mode->part, "%.*s", whole, part[0].name);
    if (!whole) {
      snprintf(mode->part, sizeof mode->part, "%s", s->body[0].name);
    }
    modal_name(mode->kind, s, &z, &part[0]);
  }
}

/* Kind and number: flap 1, lag 1, flap 2. */
static void modes_number(scene_mode *mode, int n)
{
  for (int k = 0; k < n; k++) {
    int number = 1;
    for (int i = 0; i < k; i++) {
      number += strcmp(mode[i].kind, mode[k].kind) == 0;
    }
    if (mode[k].kind[0]) {
      snprintf(mode[k].name, sizeof mode[k].name, "%s %d", mode[k].kind, number);
    }
  }
}

/* Frequencies and damping of the modes about the start, slowest first: how many; -1: the reason is in s->message. */
static int modes_solve(scene *s, scene_mode mode[SCENE_MODES])
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
    memset(&mode[k], 0, sizeof mode[k]);
    mode[k].undamped = size;
    mode[k].damped = omega;
    mode[k].ratio = size > 0 ? -growth / size + 0.0 : 0;
    mode[k].growth = growth + 0.0;
    snprintf(mode[k].what, sizeof mode[k].what, "rigid-body motion");
  }
  return n;
}

/* And what moves, and names. */
static int scene_modes(scene *s, scene_mode mode[SCENE_MODES])
{
  const int n = modes_solve(s, mode);
  for (int k = 0; k < n; k++) {
    if (mode[k].undamped > 0) {
      mode_describe(&mode[k], s, k);
    }
  }
  modes_number(mode, n);
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
  fprintf(out,
          "mode  undamped [Hz]  damped [Hz]  damped [rad/s]  damping ratio  growth [1/s]  %-8s  %-16s  what moves\n",
          "motion", "name");
  for (int k = 0; k < n; k++) {
    const scene_mode *const m = &mode[k];
    fprintf(out, "%4d  %13.6g  %11.6g  %14.6g  %13.4g  %12.4g  %-8s  %-16s  %s\n", k + 1, m->undamped / (2 * pi),
            m->damped / (2 * pi), m->damped, m->ratio, m->growth,
            m->growth > 0     ? "UNSTABLE"
            : m->growth < 0   ? "decays"
            : m->undamped > 0 ? "undamped"
                              : "free",
            m->name[0] ? m->name : "-", m->what);
  }
  return 0;
}
#endif
