/* analyse.h - particles on springs, ports and units, shared by the tests of >>trim and >>linear:
   steady states, linearization, complex modes: against characteristic polynomials in closed form, statics, the modes
   they are made of, and published frequencies of a rotor blade. */
#ifndef FBT_ANALYSE_H
#define FBT_ANALYSE_H

#include "fbt.h"

#define EPS FBT_TOL(2.2204460492503131e-16, 1.19209290e-7)
static const double pi = 3.14159265358979323846;
static fb_shape shape;
static fb_body body;
static fb_body_work body_work;
static fb_spectrum spectrum;
static fb_beam_desc line;
static fb_beam beam;
static fb_modes modes;
static fb_modes_work modes_work;
static fb_modes_desc keep;
static fb_body_desc level;

/* A uniform beam and as many bending modes each way; whatever else is in `line`, `keep`, `level` comes after. */
static inline void uniform_line(double length, int n_element, double mass, double EI_y, double EI_z, int each_way)
{
  memset(&line, 0, sizeof line);
  memset(&keep, 0, sizeof keep);
  memset(&level, 0, sizeof level);
  line.length = (fb_real)length;
  line.n_element = n_element;
  line.n_station = 1;
  line.station[0].mass = (fb_real)mass;
  line.station[0].EI_y = (fb_real)EI_y;
  line.station[0].EI_z = (fb_real)EI_z;
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = each_way;
}

/* The body of that beam with a hub (mass 0: none) and node 1 at its tip. */
static inline void beam_body(fb_body *out, double hub, const fb_real center[3], const fb_real inertia[6])
{
  fb_body_desc fitted = level;
  int node;
  fbt_fit(&fitted);
  FBT_INT_EQ(fb_beam_init(&beam, &line), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  if (hub > 0.0) {
    FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)hub, center, inertia), FB_OK);
  }
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, line.length), FB_OK);
  FBT_INT_EQ(node, 1);
  FBT_INT_EQ(fb_body_init(out, &body_work, &shape, &fitted), FB_OK);
}

/* A particle of 1 kg at (R, 0, 0) on springs k_x, k_y with dashpots, in a frame that turns about z. */
static inline void particle_on_springs(double R, double kx, double ky, double zeta)
{
  static fb_body_desc desc;
  const fb_real r[3] = {(fb_real)R, FB_R(0.0), FB_R(0.0)}, psi[6] = {FB_R(1.0), 0, 0, 0, FB_R(1.0), 0};
  memset(&desc, 0, sizeof desc);
  FBT_INT_EQ(fb_shape_init(&shape, 2), FB_OK);
  FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(1.0), r, psi, NULL), FB_OK);
  shape.K[0] = (fb_real)kx;
  shape.K[3] = (fb_real)ky;
  desc.effects = FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA | FB_EFFECT_DAMPING;
  desc.base = FB_BASE_PRESCRIBED;
  desc.zeta[0] = desc.zeta[1] = (fb_real)zeta;
  desc.deflection_limit = FB_R(10.0);
  desc.allow_split_effects = 1; /* a particle has no foreshortening */
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
}

typedef struct number { /* complex */
  double re, im;
} number;

static inline number times(number a, number b)
{
  const number c = {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
  return c;
}

static inline number plus(number a, double s, number b)
{
  const number c = {a.re + s * b.re, a.im + s * b.im};
  return c;
}

/* x on by dt along x' = A x + B u, by rk4. */
static inline void linear_step(double *x, const fb_linear *linear, const double *u, double dt)
{
  static const double at[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
  double k[FB_MAX_LINEAR] = {0}, half[FB_MAX_LINEAR], sum[FB_MAX_LINEAR] = {0};
  for (int stage = 0; stage < 4; stage++) {
    for (int i = 0; i < linear->n; i++) {
      half[i] = x[i] + at[stage] * dt * k[i];
    }
    for (int i = 0; i < linear->n; i++) {
      k[i] = 0.0;
      for (int j = 0; j < linear->n_in; j++) {
        k[i] += (double)linear->B[i * linear->n_in + j] * u[j];
      }
      for (int j = 0; j < linear->n; j++) {
        k[i] += (double)linear->A[i * linear->n + j] * half[j];
      }
      sum[i] += weight[stage] * k[i];
    }
  }
  for (int i = 0; i < linear->n; i++) {
    x[i] += dt * sum[i];
  }
}

/* y_k = C x + D u */
static inline double linear_output(const fb_linear *linear, const double *x, const double *u, int k)
{
  double y = 0.0;
  for (int j = 0; j < linear->n; j++) {
    y += (double)linear->C[k * linear->n + j] * x[j];
  }
  for (int j = 0; j < linear->n_in; j++) {
    y += (double)linear->D[k * linear->n_in + j] * u[j];
  }
  return y;
}

/* Largest |a_ij s_j/s_i - b_ij| of n x m, in parts of the largest element of the row and of a thousandth of that of
   all: a in other units, s those of rows and columns. */
static inline double units_apart(const fb_real *a, const fb_real *b, const double *row, const double *column, int n,
                                 int m)
{
  double apart = 0.0;
  for (int i = 0; i < n; i++) {
    double worst = 0.0;
    for (int j = 0; j < m; j++) {
      worst = fmax(worst, fabs((double)a[i * m + j] * column[j] / row[i] - (double)b[i * m + j]));
    }
    apart = fmax(apart, worst / (fbt_largest(b + i * m, m) + 1e-3 * fbt_largest(b, n * m)));
  }
  return apart;
}

/* ---- systems */

static fb_body part[FB_MAX_BODIES];
static fb_system_desc tree;
static fb_system mechanism;
static fb_system_analyse_work tree_work;
static fb_system_state tree_state;
static fb_system_input drive;
static fb_link_motion start[FB_MAX_BODIES];

static inline void fresh(void)
{
  memset(&tree, 0, sizeof tree);
  memset(&drive, 0, sizeof drive);
  memset(start, 0, sizeof start);
}

/* Model k: a rigid body with its mass center on x, inertia about the origin. */
static inline void rigid_part(int k, double mass, double c, double jx, double jy, double jz, double gravity)
{
  static fb_body_desc desc;
  const double off = mass * c * c;
  const fb_real center[3] = {(fb_real)c, 0, 0}, J[6] = {(fb_real)jx, (fb_real)(jy - off), (fb_real)(jz - off), 0, 0, 0};
  const fb_real tip[3] = {(fb_real)(2.0 * c), 0, 0};
  int node;
  memset(&desc, 0, sizeof desc);
  desc.base = FB_BASE_PRESCRIBED;
  desc.effects = gravity != 0.0 ? (unsigned)FB_EFFECT_GRAVITY : 0u;
  desc.gravity[0] = (fb_real)gravity;
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)mass, center, J), FB_OK);
  FBT_INT_EQ(fb_shape_add_node(&shape, &node, tip, NULL, NULL), FB_OK);
  FBT_INT_EQ(fb_body_init(&part[k], &body_work, &shape, &desc), FB_OK);
}

/* Model k: a hub and a beam along x, node 1 its tip, n bending modes each way. */
static inline void flexible_part(int k, double length, int n, fb_base base, unsigned effects)
{
  const fb_real center[3] = {FB_R(0.1), 0, 0}, J[6] = {FB_R(0.8), FB_R(0.5), FB_R(0.9), 0, 0, 0};
  uniform_line(length, 6, 0.5, 40.0, 60.0, n);
  level.effects = effects;
  level.base = base;
  for (int a = 0; a < 2 * n; a++) {
    level.zeta[a] = FB_R(0.02);
  }
  beam_body(&part[k], 2.0, center, J);
}

static inline fb_joint_desc *hang(int k, int model, fb_joint_kind kind, int parent)
{
  fb_joint_desc *const j = &tree.joint[k];
  tree.n_body = k + 1;
  tree.model[k] = model;
  j->kind = kind;
  j->parent = parent;
  return j;
}

static inline void build(void)
{
  FBT_INT_EQ(fb_system_init(&mechanism, &tree_work.system, part, &tree, fbt_models(&tree)), FB_OK);
  FBT_INT_EQ(fb_system_state_init(&mechanism, part, &tree_state, &tree_work.system, start, &drive), FB_OK);
}

static inline void trim_and_modes(void)
{
  FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), FB_OK);
  FBT_INT_EQ(fb_system_spectrum_solve(&mechanism, part, &tree_work, &spectrum, &tree_state, &drive), FB_OK);
  FBT_BELOW((double)tree_work.common.linear.error, FBT_TOL(1e-10, 1e-3)); /* as examples/MODELS.md says */
}

/* A hub that a motor turns about z at Omega, its hinge e out along x. */
static inline void rotor(double Omega)
{
  fresh();
  rigid_part(0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.0);
  hang(0, 0, FB_JOINT_REVOLUTE, FB_GROUND)->mode[0] = FB_AXIS_PRESCRIBED;
  drive.drive[0].rate[0] = (fb_real)Omega;
}

static inline void frame_turn(fb_real quat[4], double x, double y, double z)
{
  const fb_real phi[3] = {(fb_real)x, (fb_real)y, (fb_real)z};
  fb_quat_from_rotvec(quat, phi);
}

/* A hub that spins about z with two flexible booms side by side on sprung hinges, and a rod between their tips. */
static inline void boom_loop(fb_axis_mode base)
{
  fb_joint_desc *j;
  fresh();
  rigid_part(0, 5.0, 0.0, 4.0, 4.0, 4.2, 0.0);
  flexible_part(1, 0.7, 1, FB_BASE_PRESCRIBED, FB_EFFECTS_FULL | FB_EFFECT_DAMPING);
  rigid_part(2, 0.8, 0.35, 0.02, 0.14, 0.14, 0.0);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND)->mode[0] = base;
  for (int k = 1; k <= 3; k += 2) {
    j = hang(k, 1, FB_JOINT_REVOLUTE, 0);
    j->position[0] = FB_R(0.4);
    j->position[1] = k == 1 ? -FB_R(0.45) : FB_R(0.45);
    if (k == 1) { /* bodies come in their order */
      j->stiffness[0] = FB_R(30.0);
      j->damping[0] = FB_R(0.3);
      hang(2, 2, FB_JOINT_REVOLUTE, 1)->parent_node = 1;
    }
  }
  tree.n_loop = 1;
  j = &tree.loop[0];
  j->kind = FB_JOINT_SPHERICAL;
  j->parent = 2;
  j->child = 3;
  j->parent_node = j->child_node = 1;
  start[1].value[0] = FB_R(0.1);
  start[2].value[0] = FB_R(1.45);
  start[3].value[0] = -FB_R(0.1);
  drive.drive[0].rate[5] = FB_R(2.0);
}

/* ---- a disk (4 kg, with the radii of gyration 0.15 m and 0.112 m on 0.6 m) that spins at the tip of a clamped
   shaft */

static const double shaft_EI = 800.0; /* [N m^2] */

/* Model 0 the shaft with `natural` modes each way and the deflections under forces and moments at its tip, model 1 the
   disk on a bearing there. 0: not all of these could be told apart. */
static inline int shaft_with_disk(double length, double shaft, double disk, double spin, int natural)
{
  const double square = length * length / 0.36 * disk / 4.0;
  const fb_real none[3] = {0}, turn[3] = {0, (fb_real)(pi / 2), 0};
  const fb_real J[6] = {(fb_real)(0.09 * square), (fb_real)(0.05 * square), (fb_real)(0.05 * square), 0, 0, 0};
  fb_joint_desc *bearing;
  fresh();
  uniform_line(length, 6, shaft / length, shaft_EI, shaft_EI, natural);
  keep.n_load = 4;
  for (int i = 0; i < 4; i++) {
    keep.load[i].node = 6;
    keep.load[i].axis = i < 2 ? 1 + i : 2 + i;
  }
  level.base = FB_BASE_PRESCRIBED;
  level.effects = FB_EFFECTS_FULL;
  beam_body(&part[0], 0.0, NULL, NULL);
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)disk, none, J), FB_OK);
  FBT_INT_EQ(fb_body_init(&part[1], &body_work, &shape, &level), FB_OK);
  hang(0, 0, FB_JOINT_RIGID, FB_GROUND);
  bearing = hang(1, 1, FB_JOINT_REVOLUTE, 0);
  bearing->parent_node = 1;
  fb_quat_from_rotvec(bearing->attitude, turn); /* z of the joint along the shaft */
  fb_quat_from_rotvec(bearing->child_attitude, turn);
  start[1].speed[0] = (fb_real)spin;
  build();
  return part[0].n == 4 + 2 * natural;
}

/* What vanishes at a whirl of the massless shaft, y + i z = exp(i l t) at the tip. */
static inline double whirl_equation(double l, double length, double disk, double spin)
{
  const double square = length * length / 0.36 * disk / 4.0, stiff = shaft_EI / length;
  const double force = 12.0 * stiff / (length * length) - disk * l * l;
  const double moment = 4.0 * stiff - 0.05 * square * l * l + 0.09 * square * spin * l;
  return force * moment - 36.0 * stiff * stiff / (length * length);
}

/* Its four roots, by size: one on either side of +-sqrt(12 EI/(L^3 m)), where the equation is negative. */
static inline void whirls(double want[4], double length, double disk, double spin)
{
  const double middle = sqrt(12.0 * shaft_EI / (length * length * length * disk));
  for (int k = 0; k < 4; k++) {
    const double sign = k < 2 ? 1.0 : -1.0;
    double inside = sign * middle, outside = k % 2 ? sign * (1e3 * middle + 10.0 * spin) : 0.0;
    for (int i = 0; i < 200; i++) {
      const double at = 0.5 * (inside + outside);
      *(whirl_equation(at, length, disk, spin) < 0.0 ? &inside : &outside) = at;
    }
    want[k] = fabs(inside);
    for (int i = k; i > 0 && want[i] < want[i - 1]; i--) {
      const double other = want[i];
      want[i] = want[i - 1];
      want[i - 1] = other;
    }
  }
}

/* A spacecraft that spins about z: hub, two flexible blades opposite each other on sprung hinges, an antenna on a
   sprung ball joint on the axis; base: of the hub. */
static inline void spinner(fb_axis_mode base, double Omega)
{
  fb_real up[4];
  fb_joint_desc *j;
  fresh();
  rigid_part(0, 8.0, 0.0, 3.0, 4.0, 6.0, 0.0);
  flexible_part(1, 2.0, 1, FB_BASE_PRESCRIBED, FB_EFFECTS_FULL | FB_EFFECT_DAMPING);
  rigid_part(2, 1.0, 0.4, 0.1, 0.35, 0.3, 0.0);
  hang(0, 0, FB_JOINT_FREE, FB_GROUND)->mode[0] = base;
  for (int k = 1; k < 3; k++) { /* along x and -x: half a turn about z */
    j = hang(k, 1, FB_JOINT_REVOLUTE, 0);
    frame_turn(j->attitude, 0.0, 0.0, k == 1 ? 0.0 : pi);
    j->position[0] = k == 1 ? FB_R(0.5) : -FB_R(0.5);
    j->stiffness[0] = FB_R(30.0);
    j->damping[0] = FB_R(0.5);
  }
  j = hang(3, 2, FB_JOINT_SPHERICAL, 0); /* its x upwards */
  frame_turn(up, 0.0, -pi / 2, 0.0);
  frame_turn(j->child_attitude, 0.7, 0.0, 0.0);
  fb_quat_mul(j->attitude, up, j->child_attitude);
  j->position[2] = FB_R(0.3);
  j->stiffness[0] = FB_R(12.0);
  j->damping[0] = FB_R(0.2);
  drive.drive[0].rate[5] = (fb_real)Omega;
}

/* The drive with its input ports moved by u. */
static inline void ports_move(fb_system_input *input, const fb_linear_desc *ports, const double *u)
{
  *input = drive;
  for (int k = 0; k < ports->n_in; k++) {
    const fb_port *const port = &ports->in[k];
    fb_drive *const moved = &input->drive[port->body];
    if (port->kind == FB_PORT_DRIVE) {
      moved->torque[port->axis] += (fb_real)u[k];
    } else if (port->kind == FB_PORT_BASE_VELOCITY || port->kind == FB_PORT_BASE_RATE) {
      moved->rate[port->axis + (port->kind == FB_PORT_BASE_RATE ? 3 : 0)] += (fb_real)u[k];
    } else {
      fb_system_load *const load = &input->load[input->n_load++];
      load->body = port->body;
      load->load.node = port->node;
      load->load.axes = FB_AXES_BODY;
      (port->kind == FB_PORT_TORQUE ? load->load.torque : load->load.force)[port->axis] = (fb_real)u[k];
    }
  }
}

/* What an output port reads. */
static inline double port_reads(const fb_port *port, const fb_system_motion *motion)
{
  const int b = port->body;
  fb_node_motion at;
  fb_imu imu;
  FBT_INT_EQ(fb_body_node_motion_eval(&part[tree.model[b]], &at, &motion->pose[b], &motion->motion[b], port->node),
             FB_OK);
  fb_imu_eval(&imu, &at, NULL);
  return (double)(port->kind == FB_PORT_COORDINATE     ? motion->joint[b].value
                  : port->kind == FB_PORT_SPEED        ? motion->joint[b].speed
                  : port->kind == FB_PORT_RATE         ? imu.angular_rate
                  : port->kind == FB_PORT_DISPLACEMENT ? at.displacement
                  : port->kind == FB_PORT_ACCELERATION ? imu.specific_force
                                                       : at.rotation)[port->axis];
}

/* How far the linear model, integrated, is off what the system answers to five inputs that move by size[k] in their own
   ways: the worst of eight outputs, by its largest change. From the trimmed state; n coordinates there are, n_free of
   joints. */
static inline double answers_apart(const fb_port in[5], const fb_port out[8], const double size[5], int n, int n_free)
{
  static fb_linear_desc ports;
  static fb_linear linear;
  static fb_system_motion motion;
  const double dt = 2e-3;
  double x[FB_MAX_LINEAR] = {0}, first[FB_MAX_PORTS] = {0}, worst[FB_MAX_PORTS] = {0}, most[FB_MAX_PORTS] = {0};
  double apart = 0.0;
  ports.n_in = 5;
  ports.n_out = 8;
  memcpy(ports.in, in, 5 * sizeof *in);
  memcpy(ports.out, out, 8 * sizeof *out);
  FBT_INT_EQ(fb_system_trim(&mechanism, part, &tree_state, &tree_work, &drive), FB_OK);
  FBT_INT_EQ(fb_system_linearize(&mechanism, part, &tree_work, &linear, &tree_state, &drive, &ports), FB_OK);
  FBT_INT_EQ(linear.n_free, n_free);
  FBT_INT_EQ(linear.n, 2 * n);
  for (int step = -1; step < 1500; step++) {
    const double way[5] = {cos(0.003 * step), step < 300 ? 1.0 : 0.0, -0.5, 0.2 * sin(0.01 * step),
                           0.5 * sin(0.004 * step)};
    double u[5] = {0};
    fb_system_input loads;
    for (int k = 0; k < ports.n_in && step >= 0; k++) {
      u[k] = size[k] * way[k];
    }
    ports_move(&loads, &ports, u);
    if (step >= 0) {
      FBT_INT_EQ(
          fb_system_rk4_step(&mechanism, part, &tree_state, &tree_work.system, &loads, &loads, &loads, (fb_real)dt),
          FB_OK);
      linear_step(x, &linear, u, dt);
    }
    FBT_INT_EQ(fb_system_motion_eval(&mechanism, part, &tree_work.system, &motion, &tree_state, &loads), FB_OK);
    for (int k = 0; k < ports.n_out; k++) {
      const double y = port_reads(&out[k], &motion);
      first[k] = step < 0 ? y : first[k];
      worst[k] = fmax(worst[k], fabs(y - first[k] - (step < 0 ? 0.0 : linear_output(&linear, x, u, k))));
      most[k] = fmax(most[k], fabs(y - first[k]));
    }
  }
  for (int k = 0; k < ports.n_out; k++) {
    apart = fmax(apart, worst[k] / most[k]);
  }
  return apart;
}

#endif
