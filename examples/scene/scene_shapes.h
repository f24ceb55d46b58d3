/* scene_shapes.h - shapes of the modes of a scene, complex, of all its coordinates, and what they make of the points of its
   bodies. Of a system a shape has all free axes, then q of all bodies; of one body q and the six of its pose; of an exact
   beam displacement and rotation of its nodes, section axes. See scene_modes.h. */
#ifndef SCENE_SHAPES_H
#define SCENE_SHAPES_H
#include "scene_linear.h"

#define MODAL_SHAPE                                                                                 \
  (FB_MAX_BODIES * (6 + FB_MAX_MODES) > 6 * (FB_MAX_EXACT + 1) ? FB_MAX_BODIES * (6 + FB_MAX_MODES) \
                                                               : 6 * (FB_MAX_EXACT + 1))

typedef struct modal_shape {
  double re[MODAL_SHAPE], im[MODAL_SHAPE];
} modal_shape;

/* ---- shapes */

/* The coordinates of a shape that q of the bodies begins at. */
static int modal_first(const scene *s, int body)
{
  int at = scene_is_system(s) ? plant_axes_before(s, s->n_body) : 0;
  for (int b = 0; b < body; b++) {
    at += engine.body[b].n;
  }
  return at;
}

static int modal_coordinates(const scene *s)
{
  return s->is_exact          ? 6 * (exact_run.beam.n + 1)
         : scene_is_system(s) ? modal_first(s, s->n_body)
                              : engine.body[0].n + 6;
}

/* The coordinate that state i of the linear model is, i < modal_states; its momentum is state modal_momentum. */
static int modal_states(const scene *s)
{
  return scene_is_system(s) ? (plant.linear.n - plant.linear.n_rotor) / 2 : engine.body[0].n + plant.linear.n_free;
}

static int modal_coordinate(const scene *s, int i)
{
  const int n = engine.body[0].n;
  return scene_is_system(s) ? plant.linear.coordinate[i] : i < n ? i : i + 6 - plant.linear.n_free;
}

static int modal_state(const scene *s, int i)
{
  const int n = engine.body[0].n;
  return scene_is_system(s) || i < n ? i : plant.linear.n - plant.linear.n_free + i - n;
}

static int modal_momentum(const scene *s, int i)
{
  const int n = engine.body[0].n;
  return scene_is_system(s) ? modal_states(s) + i : i < n ? n + i : plant.linear.n - 2 * plant.linear.n_free + i - n;
}

/* Does it have coordinates that the spectrum leaves out: a free joint, the pose of a base that is not prescribed? */
static int modal_floats(const scene *s)
{
  int floats = !scene_is_system(s) && !s->is_exact && plant.linear.n_free > 0;
  for (int b = 0; b < s->n_body && scene_is_system(s); b++) {
    floats |= engine.system.joint[b].kind == FB_JOINT_FREE && engine.system_state.mode[b][0] == FB_AXIS_FREE &&
              !engine.system.joint[b].moored;
  }
  return floats;
}

/* An eigenvector x of the linear model by inverse iteration, beginning with what is known of it: (A - shift) x' = x, as
   real equations of twice the size. 0: it is singular. */
static int modal_iterate(double *re, double *im, double growth, double omega)
{
  enum { N = 2 * FB_MAX_LINEAR };
  static fb_real A[N * N], scale[N], x[N], b[N];
  static int perm[N];
  const int n = plant.linear.n;
  const double beside = 1e-8 * hypot(growth, omega);
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) {
      const fb_real a = plant.linear.A[n * i + j] - (i == j ? (fb_real)(growth + beside) : FB_R(0.0));
      A[2 * n * i + j] = A[2 * n * (n + i) + n + j] = a;
      A[2 * n * i + n + j] = i == j ? (fb_real)omega : FB_R(0.0);
      A[2 * n * (n + i) + j] = -A[2 * n * i + n + j];
    }
  }
  if (fb_lu_factor(A, perm, scale, 2 * n) != FB_OK) {
    return 0;
  }
  for (int round = 0; round < 3; round++) {
    fb_real most = 0;
    for (int i = 0; i < n; i++) {
      b[i] = (fb_real)re[i];
      b[n + i] = (fb_real)im[i];
    }
    fb_lu_solve(x, A, perm, b, 2 * n);
    for (int i = 0; i < 2 * n; i++) {
      most = FB_FABS(x[i]) > most ? FB_FABS(x[i]) : most;
    }
    for (int i = 0; i < n && most > 0; i++) {
      re[i] = (double)(x[i] / most);
      im[i] = (double)(x[n + i] / most);
    }
  }
  return 1;
}

/* Adds what the spectrum leaves out, in the scale of what it has. */
static void modal_complete(modal_shape *z, const scene *s, double growth, double omega)
{
  static double re[FB_MAX_LINEAR], im[FB_MAX_LINEAR];
  const int n = modal_states(s);
  double known = 0, along[2] = {0, 0};
  memset(re, 0, sizeof re);
  memset(im, 0, sizeof im);
  for (int i = 0; i < n; i++) {
    re[modal_state(s, i)] = z->re[modal_coordinate(s, i)];
    im[modal_state(s, i)] = z->im[modal_coordinate(s, i)];
    known += hypot(z->re[modal_coordinate(s, i)], z->im[modal_coordinate(s, i)]);
  }
  for (int i = 0; i < plant.linear.n && !(known > 0); i++) {
    re[i] = 1;
  }
  if (!modal_iterate(re, im, growth, omega)) {
    return;
  }
  known = 0;
  for (int i = 0; i < n; i++) { /* the factor of x to z by least squares */
    const int c = modal_coordinate(s, i), x = modal_state(s, i);
    if (hypot(z->re[c], z->im[c]) > 0) {
      along[0] += re[x] * z->re[c] + im[x] * z->im[c];
      along[1] += re[x] * z->im[c] - im[x] * z->re[c];
      known += re[x] * re[x] + im[x] * im[x];
    }
  }
  if (!(known > 0)) {
    along[0] = known = 1;
  }
  for (int i = 0; i < n; i++) {
    const int c = modal_coordinate(s, i), x = modal_state(s, i);
    z->re[c] = (along[0] * re[x] - along[1] * im[x]) / known;
    z->im[c] = (along[0] * im[x] + along[1] * re[x]) / known;
  }
}

/* The shape of mode k of the spectrum. */
static void modal_take(modal_shape *z, const scene *s, int k)
{
  const fb_real *const re = s->is_exact ? exact_run.spectrum.shape_re : engine.spectrum.shape_re;
  const fb_real *const im = s->is_exact ? exact_run.spectrum.shape_im : engine.spectrum.shape_im;
  const int n = s->is_exact || scene_is_system(s) ? modal_coordinates(s) : engine.body[0].n;
  const double growth = s->is_exact ? 0 : (double)engine.spectrum.re[k];
  const double omega = s->is_exact ? 0 : (double)engine.spectrum.im[k];
  memset(z, 0, sizeof *z);
  for (int i = 0; i < n; i++) {
    z->re[i] = (double)re[k * n + i];
    z->im[i] = (double)im[k * n + i];
  }
  if (modal_floats(s) && hypot(growth, omega) > 0) {
    modal_complete(z, s, growth, omega);
  }
}

/* ---- motion */

/* [m] The size of the scene: of its largest body. */
static double modal_length(const scene *s)
{
  double length = 0;
  for (int b = 0; b < s->n_body && !s->is_exact; b++) {
    for (int k = 0; k < engine.body[b].n_node; k++) {
      length = fmax(length, sqrt((double)fb_vec3_dot(engine.body[b].node[k].r, engine.body[b].node[k].r)));
    }
  }
  return s->is_exact ? (double)exact_run.beam.length : length > 0 ? length : 1;
}

/* How far a coordinate moves the scene, of its length and in rad. */
static double modal_reach(const scene *s, int coordinate, double length)
{
  int axis[6], at = coordinate;
  for (int b = 0; b < s->n_body && scene_is_system(s); b++) {
    const int n = linear_free_axes(axis, &engine.system, &engine.system_state, b);
    const fb_joint_kind kind = engine.system.joint[b].kind;
    if (at < n) {
      return linear_axis_slides(kind, axis[at]) || (kind == FB_JOINT_FREE && axis[at] < 3) ? 1 / length : 1;
    }
    at -= n;
  }
  for (int b = 0; b < s->n_body; b++) {
    const fb_body *const body = &engine.body[b];
    double reach = 0;
    if (at >= body->n) {
      at -= body->n;
      continue;
    }
    for (int k = 0; k < body->n_node; k++) {
      const fb_real *const psi = body->node[k].psi + 3 * at, *const theta = body->node[k].theta + 3 * at;
      reach = fmax(reach, sqrt((double)fb_vec3_dot(psi, psi)) / length);
      reach = fmax(reach, sqrt((double)fb_vec3_dot(theta, theta)));
    }
    return reach;
  }
  return at < 3 ? 1 / length : 1; /* the pose of a body alone */
}

/* How far a shape moves the scene. */
static double modal_size(const modal_shape *z, const scene *s)
{
  const double length = modal_length(s);
  double most = 0;
  for (int i = 0; i < modal_coordinates(s); i++) {
    const double reach = s->is_exact ? (i % 6 < 3 ? 1 / length : 1) : modal_reach(s, i, length);
    most = fmax(most, reach * hypot(z->re[i], z->im[i]));
  }
  return most;
}

/* Turns a quaternion by a small rotation about axes of the body. */
static void modal_turn(fb_real quat[4], const double phi[3])
{
  fb_real by[4], was[4], vector[3];
  scene_reals(vector, phi, 3);
  memcpy(was, quat, sizeof was);
  fb_quat_from_rotvec(by, vector);
  fb_quat_mul(quat, was, by);
}

/* Moves a pose by dx and phi, axes of the body. */
static void modal_move(fb_real x[3], fb_real quat[4], const double d[6])
{
  fb_real R[9], vector[3], along[3];
  fb_quat_to_mat33(R, quat);
  scene_reals(vector, d, 3);
  fb_mat33_mul_vec3(along, R, vector);
  for (int i = 0; i < 3; i++) {
    x[i] += along[i];
  }
  modal_turn(quat, d + 3);
}

/* The nodes of an exact beam. */
static fb_status modal_look_exact(const scene *s, const modal_shape *z, double cosine, double sine)
{
  const fb_status status = scene_look(s, 0);
  for (int k = 0; k <= exact_run.beam.n && status == FB_OK; k++) {
    double d[6];
    for (int i = 0; i < 6; i++) {
      d[i] = cosine * z->re[6 * k + i] + sine * z->im[6 * k + i];
    }
    modal_move(exact_run.node[k].position, exact_run.node[k].quat, d);
  }
  return status;
}

/* The start, displaced by `cosine` of the real part of a shape and `sine` of its imaginary part, into the view. */
static fb_status modal_look(const scene *s, const modal_shape *z, double cosine, double sine)
{
  static fb_system_state system_was;
  const fb_state was = engine.state;
  int at = 0, axis[6];
  fb_status status;
  if (s->is_exact) {
    return modal_look_exact(s, z, cosine, sine);
  }
  if (!scene_is_system(s)) {
    double d[6];
    for (int a = 0; a < engine.body[0].n; a++) {
      engine.state.q[a] += (fb_real)(cosine * z->re[a] + sine * z->im[a]);
    }
    for (int i = 0; i < 6; i++) {
      const int c = engine.body[0].n + i;
      d[i] = cosine * z->re[c] + sine * z->im[c];
    }
    modal_move(engine.state.rho, engine.state.quat, d);
    status = single_look(s, 0);
    engine.state = was;
    return status;
  }
  system_was = engine.system_state;
  for (int b = 0; b < s->n_body; b++) {
    fb_link_state *const link = &engine.system_state.link[b];
    const fb_joint_kind kind = engine.system.joint[b].kind;
    const int n = linear_free_axes(axis, &engine.system, &engine.system_state, b);
    double d[6] = {0};
    for (int i = 0; i < n; i++, at++) {
      d[axis[i]] = cosine * z->re[at] + sine * z->im[at];
    }
    if (kind == FB_JOINT_FREE) {
      modal_move(link->x, link->quat, d);
    } else if (kind == FB_JOINT_SPHERICAL) {
      modal_turn(link->quat, d);
    } else {
      for (int i = 0; i < n; i++) {
        link->x[axis[i]] += (fb_real)d[axis[i]];
      }
    }
  }
  for (int b = 0; b < s->n_body; b++) {
    for (int a = 0; a < engine.body[b].n; a++, at++) {
      engine.system_state.link[b].q[a] += (fb_real)(cosine * z->re[at] + sine * z->im[at]);
    }
  }
  status = system_look(s, 0);
  engine.system_state = system_was;
  return status;
}

typedef struct modal_point {  /* of a body, inertial axes */
  double x[3], line[3];       /* place at the start; direction of the body's line there, zero: it has none */
  double u[2][3], turn[2][3]; /* what a shape makes of it, real and imaginary part */
} modal_point;

/* Places and attitudes of the nodes of a body in the view. */
static int modal_nodes(fb_node_motion *node, int b)
{
  const fb_body *const body = &engine.body[b];
  for (int k = 0; k < body->n_node; k++) {
    if (fb_body_node_motion_eval(body, &node[k], &engine.view.motion.pose[b], &engine.view.motion.motion[b], k) !=
        FB_OK) {
      return 0;
    }
  }
  return body->n_node;
}

static void modal_unit(double x[3])
{
  const double size = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
  for (int i = 0; i < 3; i++) {
    x[i] = size > 0 ? x[i] / size : 0;
  }
}

static double modal_dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void modal_cross(double c[3], const double a[3], const double b[3])
{
  for (int i = 0; i < 3; i++) {
    c[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
  }
}

/* Points of body b and what a shape makes of them: half the difference of the start displaced forward and backward by a
   ten-thousandth. Returns how many; 0: the motion cannot be looked at. */
static int modal_points(modal_point *point, const scene *s, const modal_shape *z, int b)
{
  static fb_node_motion ahead[FB_MAX_NODES], behind[FB_MAX_NODES];
  const double far = 1e-4 / modal_size(z, s);
  const scene_body *const body = &s->body[b];
  int n = 0;
  for (int part = 0; part < 2; part++) {
    const double cosine = part ? 0 : far, sine = part ? far : 0;
    n = modal_look(s, z, cosine, sine) == FB_OK ? modal_nodes(ahead, b) : 0;
    n = n && modal_look(s, z, -cosine, -sine) == FB_OK ? modal_nodes(behind, b) : 0;
    for (int k = 0; k < n; k++) {
      fb_real back[4], turn[4], phi[3];
      for (int i = 0; i < 4; i++) {
        back[i] = i ? -behind[k].quat[i] : behind[k].quat[i];
      }
      fb_quat_mul(turn, ahead[k].quat, back);
      fb_quat_to_rotvec(phi, turn);
      for (int i = 0; i < 3; i++) {
        point[k].x[i] = 0.5 * (double)(ahead[k].position[i] + behind[k].position[i]);
        point[k].u[part][i] = 0.5 * (double)(ahead[k].position[i] - behind[k].position[i]) / far;
        point[k].turn[part][i] = 0.5 * (double)phi[i] / far;
        point[k].line[i] = 0;
      }
    }
  }
  for (int k = body->n_node; k < n && body->n_drawn > 1; k++) { /* along beams */
    const int on = (k - body->n_node) % body->n_drawn, last = body->n_drawn - 1;
    for (int i = 0; i < 3; i++) {
      point[k].line[i] = point[k + (on < last)].x[i] - point[k - (on > 0)].x[i];
    }
    modal_unit(point[k].line);
  }
  return n;
}

/* Those of an exact beam. */
static int modal_points_exact(modal_point *point, const modal_shape *z)
{
  const int n = exact_run.beam.n + 1;
  for (int k = 0; k < n; k++) {
    const int inboard = k > 0 ? exact_run.beam.inboard[k - 1] : 0, from = k > 0 ? inboard : 0, to = k > 0 ? k : 1;
    fb_real R[9];
    fb_quat_to_mat33(R, exact_run.node[k].quat);
    for (int i = 0; i < 3; i++) {
      point[k].x[i] = (double)exact_run.node[k].position[i];
      point[k].line[i] = (double)(exact_run.node[to].position[i] - exact_run.node[from].position[i]);
      for (int part = 0; part < 2; part++) {
        const double *const d = (part ? z->im : z->re) + 6 * k;
        point[k].u[part][i] = point[k].turn[part][i] = 0;
        for (int j = 0; j < 3; j++) {
          point[k].u[part][i] += (double)R[3 * i + j] * d[j];
          point[k].turn[part][i] += (double)R[3 * i + j] * d[3 + j];
        }
      }
    }
    modal_unit(point[k].line);
  }
  return n;
}

/* ---- spin */

/* [rad/s] Angular velocity of a body at the start, inertial axes; its size. */
static double modal_spin(double w[3], const scene *s, int b)
{
  fb_real R[9], along[3];
  fb_quat_to_mat33(R, engine.view.motion.pose[b].quat);
  if (s->is_exact) {
    fb_mat33_mul_vec3(along, R, exact_run.input.w);
  } else {
    fb_mat33_mul_vec3(along, R, engine.view.motion.motion[b].w);
  }
  for (int i = 0; i < 3; i++) {
    w[i] = (double)along[i];
  }
  return sqrt(modal_dot(w, w));
}

/* [rad/s] Of the body that spins fastest: its spin and which it is. The view has the start. */
static double scene_spin(const scene *s, int *body)
{
  double w[3], most = 0;
  *body = 0;
  for (int b = 0; b < s->n_body; b++) {
    const double spin = modal_spin(w, s, b);
    if (spin > most * (1 + 1e-9)) {
      most = spin;
      *body = b;
    }
  }
  return most;
}
#endif
