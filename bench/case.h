/* case.h - eight scenes, each run by modal bodies of any set of effects and by the geometrically exact beam. A scene is
   one uniform beam, with or without bodies on its ends, and a drive: what its base does and what acts on it. */
#ifndef FBB_CASE_H
#define FBB_CASE_H

#include "check.h"
#include "../examples/common/boom.h"
#include "../examples/common/clock.h"
#include "../examples/common/stepper.h"
#include <math.h>

#define FBB_COUNT(array) ((int)(sizeof(array) / sizeof((array)[0])))
#ifndef FBB_SAMPLES
#define FBB_SAMPLES 160 /* at equal times after the start */
#endif
#ifndef FBB_BETWEEN
#define FBB_BETWEEN 0 /* nodes of a body beside root, middle and tip, at equal distances: for pictures */
#endif
#define FBB_PI 3.14159265358979323846

enum { FBB_ROOT = 0, FBB_MIDDLE = 1, FBB_TIP = 2, FBB_NODES = 3 };

typedef struct fbb_case fbb_case;

typedef struct fbb_drive {               /* at an instant */
  double v[3], w[3], v_dot[3], w_dot[3]; /* of a prescribed base, its axes */
  double force[3], torque[3];            /* on the node `at` */
} fbb_drive;

struct fbb_case {
  const char *name, *what;
  double mass, EI_y, EI_z, i_y, i_z, length; /* [kg/m], [N m^2], [kg m], [m]; stiff along, in shear and torsion */
  fb_root root;
  fb_base base;
  double hub_mass, hub_inertia;         /* at the root [kg], [kg m^2] */
  double payload_mass, payload_inertia; /* at the tip */
  double gravity[3];                    /* [m/s^2] */
  double spin[3];                       /* [rad/s] at the start */
  double duration;                      /* [s] */
  double size, period;                  /* of the drive */
  void (*drive)(fbb_drive *drive, const fbb_case *c, double t);
  int at;     /* FBB_...: where force and torque act */
  int steady; /* starts from the steady state under its spin */
  int chord;  /* output: the middle against the line between the ends; else the tip against the root, root axes */
  int y, z;   /* bends in these planes */
  int elements, steps; /* of the coarsest of the three runs of the reference, steps between samples; 0: 16, 8 */
};

/* ---- drives */

static void fbb_drive_none(fbb_drive *d, const fbb_case *c, double t)
{
  (void)d, (void)c, (void)t;
}

/* The base turns about z up to `size` [rad/s] within `period`, smoothly. */
static void fbb_drive_spinup(fbb_drive *d, const fbb_case *c, double t)
{
  const double phase = 2 * FBB_PI * t / c->period;
  d->w[2] = t < c->period ? c->size / c->period * (t - c->period / (2 * FBB_PI) * sin(phase)) : c->size;
  d->w_dot[2] = t < c->period ? c->size / c->period * (1 - cos(phase)) : 0.0;
}

/* Steady spin; a force on the tip along z from 0 to `size` [N] and back in each `period`. */
static void fbb_drive_flap(fbb_drive *d, const fbb_case *c, double t)
{
  for (int i = 0; i < 3; i++) {
    d->w[i] = c->spin[i];
  }
  d->force[2] = 0.5 * c->size * (1 - cos(2 * FBB_PI * t / c->period));
}

/* A torque on the hub about z, `size` sin [N m] for one period: from rest to rest. */
static void fbb_drive_slew(fbb_drive *d, const fbb_case *c, double t)
{
  d->torque[2] = t < c->period ? c->size * sin(2 * FBB_PI * t / c->period) : 0.0;
}

/* A joint turns by `size` [rad] about z within `period`, with a polynomial of least jerk. */
static void fbb_drive_joint(fbb_drive *d, const fbb_case *c, double t)
{
  const double s = t < c->period ? t / c->period : 1.0;
  d->w[2] = c->size / c->period * 30 * s * s * (1 - s) * (1 - s);
  d->w_dot[2] = c->size / (c->period * c->period) * 60 * s * (1 - s) * (1 - 2 * s);
}

/* The base shakes along z by up to `size` [m/s^2] with five oscillations in `period`, swelling and fading. */
static void fbb_drive_shake(fbb_drive *d, const fbb_case *c, double t)
{
  const double omega = 10 * FBB_PI / c->period, swell = FBB_PI / c->period, V = c->size / omega;
  if (t < c->period) {
    d->v[2] = V * sin(swell * t) * sin(swell * t) * sin(omega * t);
    d->v_dot[2] =
        V * (swell * sin(2 * swell * t) * sin(omega * t) + omega * sin(swell * t) * sin(swell * t) * cos(omega * t));
  }
}

/* A push on the tip of a body that flies, inertial axes, up to `size` [N] and back within `period`. */
static void fbb_drive_hit(fbb_drive *d, const fbb_case *c, double t)
{
  const double s = t < c->period ? c->size * sin(FBB_PI * t / c->period) * sin(FBB_PI * t / c->period) : 0.0;
  d->force[1] = s;
  d->force[2] = 0.5 * s;
}

/* ---- scenes */

static const fbb_case fbb_cases[] = {
    {.name = "spin-up",
     .what = "a boom's base spins up to above its first frequency (p07C)",
     .mass = BOOM_LINE,
     .EI_y = BOOM_EI,
     .EI_z = BOOM_EI,
     .length = BOOM_LENGTH,
     .base = FB_BASE_PRESCRIBED,
     .duration = 30,
     .size = 6,
     .period = 15,
     .drive = fbb_drive_spinup,
     .y = 1},
    {.name = "rotor",
     .what = "a blade in fast steady rotation, a flap load once per turn",
     .mass = 1.0,
     .EI_y = 4000,
     .EI_z = 40000,
     .length = 5,
     .base = FB_BASE_PRESCRIBED,
     .spin = {0, 0, 20},
     .duration = 1.5,
     .size = 60,
     .period = 0.314159265358979,
     .drive = fbb_drive_flap,
     .at = FBB_TIP,
     .steady = 1,
     .y = 1,
     .z = 1},
    {.name = "slew",
     .what = "a spacecraft with a boom turns by a torque on its hub",
     .mass = 0.5,
     .EI_y = 500,
     .EI_z = 500,
     .length = 8,
     .hub_mass = 200,
     .hub_inertia = 80,
     .duration = 30,
     .size = 8,
     .period = 20,
     .drive = fbb_drive_slew,
     .y = 1},
    {.name = "arm",
     .what = "a robot link lifts a payload by a quarter turn",
     .mass = 1.5,
     .EI_y = 1500,
     .EI_z = 1500,
     .length = 1.2,
     .payload_mass = 4,
     .payload_inertia = 0.01,
     .base = FB_BASE_PRESCRIBED,
     .gravity = {0, -9.81, 0},
     .duration = 2,
     .size = 1.5707963267949,
     .period = 1,
     .drive = fbb_drive_joint,
     .y = 1,
     .steps = 16},
    {.name = "pendulum",
     .what = "a flexible pendulum falls from the horizontal",
     .mass = 0.5,
     .EI_y = 2,
     .EI_z = 2,
     .length = 1,
     .root = FB_ROOT_PINNED,
     .base = FB_BASE_HINGED,
     .gravity = {0, -9.81, 0},
     .duration = 2,
     .drive = fbb_drive_none,
     .chord = 1,
     .y = 1,
     .elements = 32,
     .steps = 64},
    {.name = "shaken",
     .what = "a cantilever on a base that shakes",
     .mass = 0.3,
     .EI_y = 20,
     .EI_z = 20,
     .length = 1.5,
     .base = FB_BASE_PRESCRIBED,
     .duration = 3,
     .size = 5,
     .period = 2,
     .drive = fbb_drive_shake,
     .z = 1},
    {.name = "tumbling",
     .what = "a free beam tumbles after a push on its tip",
     .mass = 1,
     .EI_y = 20,
     .EI_z = 30,
     .i_y = 0.04,
     .i_z = 0.06,
     .length = 3,
     .root = FB_ROOT_FREE,
     .spin = {1, 2, 3},
     .duration = 5,
     .size = 5,
     .period = 0.5,
     .drive = fbb_drive_hit,
     .at = FBB_TIP,
     .chord = 1,
     .y = 1,
     .z = 1,
     .elements = 32},
    {.name = "sag",
     .what = "a slender cantilever drops under its weight, far",
     .mass = 0.4,
     .EI_y = 40,
     .EI_z = 40,
     .length = 2,
     .base = FB_BASE_PRESCRIBED,
     .gravity = {0, 0, -9.81},
     .duration = 4,
     .drive = fbb_drive_none,
     .z = 1,
     .steps = 64},
};

/* ---- what both kinds of model share */

/* The largest spin [rad/s] of a scene, for the limit of the step. */
static double fbb_largest_spin(const fbb_case *c)
{
  const double *w = c->spin;
  const double driven = c->drive == fbb_drive_spinup  ? c->size
                        : c->drive == fbb_drive_joint ? 2 * c->size / c->period
                                                      : 0;
  return sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]) + driven;
}

static fb_section fbb_section(const fbb_case *c)
{
  fb_section section;
  memset(&section, 0, sizeof section);
  section.mass = (fb_real)c->mass;
  section.EI_y = (fb_real)c->EI_y;
  section.EI_z = (fb_real)c->EI_z;
  section.i_y = (fb_real)c->i_y;
  section.i_z = (fb_real)c->i_z;
  return section;
}

static fb_lump fbb_lump(int node, double mass, double inertia)
{
  fb_lump lump;
  memset(&lump, 0, sizeof lump);
  lump.node = node;
  lump.mass = (fb_real)mass;
  lump.inertia[0] = lump.inertia[1] = lump.inertia[2] = (fb_real)inertia;
  return lump;
}

static void fbb_drive_at(fbb_drive *drive, const fbb_case *c, double t)
{
  memset(drive, 0, sizeof *drive);
  c->drive(drive, c, t);
}

/* The load of the drive on that node: in body axes, of a free body in inertial axes. */
static void fbb_load_set(fb_load *load, const fbb_case *c, const fbb_drive *drive, int node)
{
  load->node = node;
  load->axes = c->base == FB_BASE_FREE ? FB_AXES_INERTIAL : FB_AXES_BODY;
  for (int i = 0; i < 3; i++) {
    load->force[i] = (fb_real)drive->force[i];
    load->torque[i] = (fb_real)drive->torque[i];
  }
}

/* Output [m] from positions and attitudes (section to inertial axes) of root, middle and tip. */
static void fbb_output(double out[3], const fbb_case *c, fb_real x[FBB_NODES][3], fb_real quat[FBB_NODES][4])
{
  fb_real R[9], d[3], y[3];
  fb_quat_to_mat33(R, quat[c->chord ? FBB_MIDDLE : FBB_ROOT]);
  for (int i = 0; i < 3; i++) {
    d[i] = c->chord ? x[FBB_MIDDLE][i] - FB_R(0.5) * (x[FBB_ROOT][i] + x[FBB_TIP][i]) : x[FBB_TIP][i] - x[FBB_ROOT][i];
  }
  fb_mat33_mulT_vec3(y, R, d);
  for (int i = 0; i < 3; i++) {
    out[i] = (double)y[i] - (i == 0 && !c->chord ? c->length : 0.0);
  }
}

typedef struct fbb_history {
  double out[FBB_SAMPLES][3];
  double ns_per_s; /* nanoseconds of stepping per simulated second */
  fb_status status;
} fbb_history;

/* Largest difference of two histories by the largest value of the second. */
static double fbb_difference(const fbb_history *a, const fbb_history *b)
{
  double most = 0.0, size = 0.0;
  for (int k = 0; k < FBB_SAMPLES; k++) {
    double d = 0.0, s = 0.0;
    for (int i = 0; i < 3; i++) {
      d += (a->out[k][i] - b->out[k][i]) * (a->out[k][i] - b->out[k][i]);
      s += b->out[k][i] * b->out[k][i];
    }
    if (!(d < HUGE_VAL)) {
      return HUGE_VAL;
    }
    most = d > most ? d : most;
    size = s > size ? s : size;
  }
  return sqrt(most / size);
}

/* ---- the exact beam */

static void fbb_exact_init(fb_exact *exact, const fbb_case *c, int n_element)
{
  static fb_exact_desc desc;
  const fb_section section = fbb_section(c);
  memset(&desc, 0, sizeof desc);
  desc.length = (fb_real)c->length;
  desc.n_element = n_element;
  desc.n_station = 1;
  desc.root = c->base == FB_BASE_FREE     ? FB_END_FREE
              : c->base == FB_BASE_HINGED ? FB_END_CLAMPED & ~FB_HOLD_RZ
                                          : FB_END_CLAMPED;
  if (c->hub_mass > 0.0) {
    desc.lump[desc.n_lump++] = fbb_lump(0, c->hub_mass, c->hub_inertia);
  }
  if (c->payload_mass > 0.0) {
    desc.lump[desc.n_lump++] = fbb_lump(n_element, c->payload_mass, c->payload_inertia);
  }
  for (int i = 0; i < 3; i++) {
    desc.gravity[i] = (fb_real)c->gravity[i];
  }
  fbb_check(fb_exact_station_init(&desc.station[0], &section), "section");
  fbb_check(fb_exact_init(exact, &desc), "exact beam");
}

static void fbb_exact_input(fb_exact_input *input, const fbb_case *c, const fb_exact *exact, double t)
{
  fbb_drive drive;
  fbb_drive_at(&drive, c, t);
  input->n_load = 1;
  fbb_load_set(&input->load[0], c, &drive, c->at * exact->n / 2);
  for (int i = 0; i < 3; i++) {
    input->v[i] = (fb_real)(c->base == FB_BASE_FREE ? 0.0 : drive.v[i]);
    input->w[i] = (fb_real)(c->base == FB_BASE_FREE ? c->spin[i] : drive.w[i]);
  }
}

/* A run of it, as far as it has come. */
typedef struct fbb_exact_flight {
  fb_exact exact;
  fb_exact_state state;
  fb_exact_work work;
  fb_exact_input input;
  fb_exact_node node[FB_MAX_EXACT + 1];
  double dt; /* [s] */
  int step;
} fbb_exact_flight;

/* At the start, with n_element elements (even) and `steps` steps between samples. */
static fb_status fbb_exact_begin(fbb_exact_flight *f, const fbb_case *c, int n_element, int steps)
{
  fb_status status;
  memset(&f->input, 0, sizeof f->input);
  f->dt = c->duration / (FBB_SAMPLES * steps);
  f->step = 0;
  fbb_exact_init(&f->exact, c, n_element);
  fbb_exact_input(&f->input, c, &f->exact, 0.0);
  if (c->base == FB_BASE_FREE) { /* of the root: the mass center rests */
    for (int i = 0; i < 3; i++) {
      const double arm[3] = {0.5 * c->length, 0.0, 0.0};
      f->input.v[i] = (fb_real)(-(c->spin[(i + 1) % 3] * arm[(i + 2) % 3] - c->spin[(i + 2) % 3] * arm[(i + 1) % 3]));
    }
  }
  status = fb_exact_state_init(&f->exact, &f->state, &f->work, &f->input);
  return status || !c->steady ? status : fb_exact_trim(&f->exact, &f->state, &f->work, &f->input);
}

static fb_status fbb_exact_advance(fbb_exact_flight *f, const fbb_case *c, int steps)
{
  fb_status status = FB_OK;
  for (int i = 0; i < steps && status == FB_OK; i++) {
    fbb_exact_input(&f->input, c, &f->exact, (f->step + 0.5) * f->dt);
    status = fb_exact_step(&f->exact, &f->state, &f->work, &f->input, (fb_real)f->dt);
    f->step++;
  }
  return status;
}

static void fbb_exact_output(double out[3], fbb_exact_flight *f, const fbb_case *c)
{
  fb_real x[FBB_NODES][3], quat[FBB_NODES][4];
  fbb_check(fb_exact_nodes_eval(&f->exact, f->node, &f->state), "exact beam");
  for (int j = 0; j < FBB_NODES; j++) {
    memcpy(x[j], f->node[j * f->exact.n / 2].position, sizeof x[j]);
    memcpy(quat[j], f->node[j * f->exact.n / 2].quat, sizeof quat[j]);
  }
  fbb_output(out, c, x, quat);
}

static void fbb_exact_run(fbb_history *history, const fbb_case *c, int n_element, int steps)
{
  static fbb_exact_flight flight;
  double time = 0.0;
  fbb_check(fbb_exact_begin(&flight, c, n_element, steps), "exact beam's start");
  history->status = FB_OK;
  for (int k = 0; k < FBB_SAMPLES && history->status == FB_OK; k++) {
    const double start = clock_own_ns();
    history->status = fbb_exact_advance(&flight, c, steps);
    time += clock_own_ns() - start;
    fbb_exact_output(history->out[k], &flight, c);
  }
  history->ns_per_s = time / c->duration;
}

/* The exact beam's solution that meshes and steps lead to, both halved: of order 2 in both. */
static void fbb_extrapolate_row(double out[3], const double coarse[3], const double fine[3])
{
  for (int i = 0; i < 3; i++) {
    out[i] = fine[i] + (fine[i] - coarse[i]) / 3;
  }
}

/* ---- modal bodies */

/* What deforms: bending modes along y and z, or with `elements` > 0 their cubic functions in both directions and along
   the beam, for nonlinear strain. */
typedef struct fbb_basis {
  int y, z, elements;
  int load;    /* 1, 2: static shapes of loads on the tip along y, z among the modes; 3: both */
  int points;  /* along a geometrically exact beam; 0: as many as the library takes */
  double spin; /* [rad/s] half of the modes are those under it */
} fbb_basis;

/* Natural modes; of a scene in steady rotation, those about it. */
static fbb_basis fbb_modes_of(const fbb_case *c, int y, int z)
{
  const fbb_basis basis = {y, z, 0, 0, 0, c->steady ? c->spin[2] : 0.0};
  return basis;
}

/* Stiff along the beam: a million times as a spring as it is in bending over its length. */
static fb_real fbb_axial_stiffness(const fbb_case *c)
{
  return (fb_real)(1e6 * fmax(c->EI_y, c->EI_z) / (c->length * c->length));
}

/* Shape with nodes 1, 2, 3 at root, middle and tip. */
static void fbb_shape_make(fb_shape *shape, const fbb_case *c, const fbb_basis *basis)
{
  static const fb_real center[3] = {0};
  static fb_beam_desc desc;
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work work;
  fb_modes_desc keep;
  int node;
  memset(&desc, 0, sizeof desc);
  memset(&keep, 0, sizeof keep);
  desc.length = (fb_real)c->length;
  desc.n_element = basis->elements ? basis->elements : basis->y > 6 || basis->z > 6 ? 20 : 8;
  desc.root = c->root;
  desc.n_station = 1;
  desc.station[0] = fbb_section(c);
  if (c->root == FB_ROOT_FREE) {
    desc.position[0] = (fb_real)(-0.5 * c->length);
  }
  if (c->payload_mass > 0.0) {
    desc.lump[desc.n_lump++] = fbb_lump(desc.n_element, c->payload_mass, c->payload_inertia);
  }
  keep.count[FB_KIND_BEND_Y] = basis->elements && basis->y ? FB_ALL_MODES : basis->y - (basis->load & 1);
  keep.count[FB_KIND_BEND_Z] = basis->elements && basis->z ? FB_ALL_MODES : basis->z - (basis->load >> 1);
  if (basis->elements) {
    desc.station[0].EA = fbb_axial_stiffness(c);
    keep.basis = FB_BASIS_FUNCTIONS;
    keep.root_strain = 1;
    keep.count[FB_KIND_AXIAL] = FB_ALL_MODES;
  } else {
    keep.spin = (fb_real)basis->spin;
    keep.line_points = basis->points;
    for (int axis = 1; axis < 3; axis++) {
      if (basis->load & axis) {
        keep.load[keep.n_load].node = desc.n_element;
        keep.load[keep.n_load++].axis = axis;
      }
    }
  }
  fbb_check(fb_beam_init(&beam, &desc), "beam");
  fbb_check(fb_modes_solve(&modes, &work, &beam, &keep), "modes");
  fbb_check(fb_shape_init(shape, modes.n), "shape");
  if (c->hub_mass > 0.0) {
    const fb_real j = (fb_real)c->hub_inertia, inertia[6] = {j, j, j, 0, 0, 0};
    fbb_check(fb_shape_add_rigid(shape, (fb_real)c->hub_mass, center, inertia), "hub");
  }
  fbb_check(fb_shape_add_beam(shape, 0, &beam, &modes), "beam");
  if (basis->elements) {
    fbb_check(fb_shape_add_beam_strain(shape, 0, &beam, &modes), "strain");
  }
  for (int j = 0; j < FBB_NODES; j++) {
    fbb_check(fb_shape_add_beam_node(shape, &node, 0, &beam, &modes, (fb_real)(0.5 * j * c->length)), "node");
  }
  for (int j = 1; j <= FBB_BETWEEN; j++) {
    fbb_check(fb_shape_add_beam_node(shape, &node, 0, &beam, &modes, (fb_real)(j * c->length / (FBB_BETWEEN + 1))),
              "node");
  }
}

static int fbb_has_gravity(const fbb_case *c)
{
  return c->gravity[0] != 0.0 || c->gravity[1] != 0.0 || c->gravity[2] != 0.0;
}

static void fbb_body_desc_make(fb_body_desc *desc, const fbb_case *c, unsigned effects)
{
  memset(desc, 0, sizeof *desc);
  desc->effects = effects;
  desc->base = c->base;
  desc->allow_long_step = 1;
  desc->deflection_limit = (fb_real)c->length;
  for (int i = 0; i < 3; i++) {
    desc->gravity[i] = (fb_real)c->gravity[i];
  }
}

static void fbb_input_at(fb_input *input, const fbb_case *c, double t)
{
  fbb_drive drive;
  fbb_drive_at(&drive, c, t);
  input->n_load = 1;
  fbb_load_set(&input->load[0], c, &drive, c->at + 1);
  for (int i = 0; i < 3; i++) {
    input->v[i] = (fb_real)drive.v[i];
    input->w[i] = (fb_real)drive.w[i];
    input->v_dot[i] = (fb_real)drive.v_dot[i];
    input->w_dot[i] = (fb_real)drive.w_dot[i];
  }
}

static void fbb_body_output(double out[3], const fbb_case *c, const fb_body *body, const fb_state *state)
{
  static fb_motion rest; /* positions want no velocities */
  fb_real x[FBB_NODES][3], quat[FBB_NODES][4];
  fb_node_motion node;
  for (int j = 0; j < FBB_NODES; j++) {
    fbb_check(fb_body_node_motion_eval(body, &node, state, &rest, j + 1), "node");
    memcpy(x[j], node.position, sizeof x[j]);
    memcpy(quat[j], node.quat, sizeof quat[j]);
  }
  fbb_output(out, c, x, quat);
}

/* A run of a body, as far as it has come. */
typedef struct fbb_body_flight {
  fb_stepper by;
  fb_exponential exponential;
  union {
    fb_body_work body;
    fb_analyse_work analyse;
  } work;
  fb_input input[3]; /* at the start, the middle and the end of a step */
  fb_state state;
  double dt; /* [s] */
  int step;
} fbb_body_flight;

/* At the start, with `steps` steps between samples. */
static fb_status fbb_body_begin(fbb_body_flight *f, const fbb_case *c, const fb_body *body, fb_integrator integrator,
                                int steps)
{
  const fb_real zero[3] = {0}, spin[3] = {(fb_real)c->spin[0], (fb_real)c->spin[1], (fb_real)c->spin[2]};
  fb_status status;
  memset(f->input, 0, sizeof f->input);
  f->dt = c->duration / (FBB_SAMPLES * steps);
  f->step = 0;
  fbb_input_at(&f->input[2], c, 0.0);
  fbb_check(fb_state_init(body, &f->state), "state");
  status = c->steady ? fb_body_trim(body, &f->state, &f->work.analyse, &f->input[2])
                     : fb_state_from_velocity(body, &f->state, zero, spin, NULL);
  return status ? status
                : body_stepper(&f->by, &f->exponential, &f->work.body, body, &f->state, f->input, integrator, f->dt);
}

static fb_status fbb_body_advance(fbb_body_flight *f, const fbb_case *c, int steps)
{
  fb_status status = FB_OK;
  for (int i = 0; i < steps && status == FB_OK; i++) {
    f->input[0] = f->input[2];
    fbb_input_at(&f->input[1], c, (f->step + 0.5) * f->dt);
    fbb_input_at(&f->input[2], c, (f->step + 1) * f->dt);
    status = fb_stepper_step(&f->by);
    f->step++;
  }
  return status;
}

/* Runs the body with `steps` steps between samples; its status says whether it came to the end. */
static void fbb_body_run(fbb_history *history, const fbb_case *c, const fb_body *body, fb_integrator integrator,
                         int steps)
{
  static fbb_body_flight flight;
  static fb_state sample[FBB_SAMPLES];
  double start;
  history->status = fbb_body_begin(&flight, c, body, integrator, steps);
  start = clock_own_ns();
  for (int k = 0; k < FBB_SAMPLES && history->status == FB_OK; k++) {
    history->status = fbb_body_advance(&flight, c, steps);
    sample[k] = flight.state;
  }
  history->ns_per_s = (clock_own_ns() - start) / c->duration;
  for (int k = 0; k < FBB_SAMPLES && history->status == FB_OK; k++) {
    fbb_body_output(history->out[k], c, body, &sample[k]);
  }
}

#endif
