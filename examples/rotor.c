/* rotor - a helicopter rotor of four articulated, flexible blades: how its disc answers to the pitch of the blades.
   The shaft turns at a prescribed rate. At the offset e each blade hangs on a hinge for lag and flap (a universal joint
   with a lag damper, its cross without mass), and on that by its pitch bearing, whose angle is prescribed: collective
   and cyclic. Strips carry the lift of thin airfoils, quasi-steady, in a uniform inflow.
   Blade azimuth psi_k = psi + k pi/2, psi = 0 downwind; pitch and flap
     theta = theta_0 + theta_1c cos psi + theta_1s sin psi,   beta = beta_0 + beta_1c cos psi + beta_1s sin psi
   with beta from multiblade (Coleman) coordinates of the tips: coning, and tilt of the disc.
   Checks: the flap frequency in vacuum, nu^2 = 1 + e S/I + k/(I Omega^2), and the answer in hover, both of rigid blades
   in closed form; the balances of energy and of angular momentum about the shaft.
   Exit: 0 well, 1 a check failed or the motion left the model, 2 bad options or a file that cannot be written. */
#define _POSIX_C_SOURCE 200809L /* popen, for gnuplot */
#define FB_MAX_BODIES 9         /* hub, four crosses, four blades */
#define FB_MAX_LOADS 16         /* four strips on each blade */
#define FB_MAX_MODES 4
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#define PROGRAM "rotor"
#include "common/options.h"
#include "common/output.h"
#include "common/plot.h"

#define MAX_ROWS 8192
static const double pi = 3.14159265358979324, degree = 3.14159265358979324 / 180.0;

enum { BLADES = 4, STRIPS = 4, TIP = STRIPS + 1 }; /* nodes of a blade: strips 1 to 4, then the tip */
enum { HUB_MODEL, CROSS_MODEL, BLADE_MODEL, MODELS };
enum { LAG, FLAP };            /* axes of the hinge */
#define CROSS(k) (1 + 2 * (k)) /* bodies of blade k; the hub is body 0 */
#define BLADE(k) (2 + 2 * (k))

typedef struct options {
  double spin, radius, offset, mass, ei_flap, ei_lag, flap_spring, lag_damper; /* the rotor */
  double chord, lift_slope, drag, density, inflow, advance;                    /* its air */
  double collective, cyclic_cos, cyclic_sin, revolutions, steps;
  const char *out;
} options;

static const char help[] =
    "rotor - answer of a rotor of four articulated, flexible blades to collective and cyclic pitch\n"
    "usage: rotor [options]\n"
    "the rotor\n"
    "  --spin W          [rad/s] of the shaft (44)\n"
    "  --radius R        [m] (5)\n"
    "  --offset E        [m] of the flap and lag hinges (0.25)\n"
    "  --mass M          [kg/m] of a blade (5.5)\n"
    "  --ei-flap EI      [N m^2] bending stiffness (9000)\n"
    "  --ei-lag EI       [N m^2] (130000)\n"
    "  --flap-spring K   [N m/rad] on the flap hinge (0)\n"
    "  --lag-damper C    [N m s/rad] on the lag hinge (2000)\n"
    "its air\n"
    "  --chord C         [m] (0.27)\n"
    "  --lift-slope A    [1/rad] (5.7)\n"
    "  --drag CD         drag coefficient of the profile (0.01)\n"
    "  --density RHO     [kg/m^3] (1.225)\n"
    "  --inflow V        [m/s] downward, uniform (that of momentum theory in hover)\n"
    "  --advance MU      wind in the disc's plane by tip speed, 0..0.4; other than 0 has no closed form here (0)\n"
    "the pitch\n"
    "  --collective A    [deg] (8)\n"
    "  --cyclic-cos A    [deg] (0)\n"
    "  --cyclic-sin A    [deg] (2)\n"
    "the computation\n"
    "  --revolutions N   per run, the last one is averaged; 10..1000 (30)\n"
    "  --steps N         per revolution, even, 100..10000 (360)\n"
    "  --out FILE        CSV of the run with flexible blades; beside it a picture (SVG) when gnuplot is there\n"
    "                    (rotor.csv)\n"
    "  --help            this text\n"
    "The closed forms are those of rigid blades at small angles: a soft blade on a stiff flap spring, a steep "
    "collective\n"
    "or a loaded slow rotor are not near them, and their checks fail.\n";

static int read_option(void *target, const char *name, const char *text)
{
  options *const o = target;
  const number_option numbers[] = {{"--spin", &o->spin, 0.1, 1000},
                                   {"--radius", &o->radius, 0.1, 100},
                                   {"--offset", &o->offset, 0, 50},
                                   {"--mass", &o->mass, 1e-3, 1e4},
                                   {"--ei-flap", &o->ei_flap, 1e-3, 1e12},
                                   {"--ei-lag", &o->ei_lag, 1e-3, 1e12},
                                   {"--flap-spring", &o->flap_spring, 0, 1e9},
                                   {"--lag-damper", &o->lag_damper, 0, 1e9},
                                   {"--chord", &o->chord, 1e-3, 10},
                                   {"--lift-slope", &o->lift_slope, 0.1, 10},
                                   {"--drag", &o->drag, 0, 1},
                                   {"--density", &o->density, 1e-6, 1e3},
                                   {"--inflow", &o->inflow, -100, 100},
                                   {"--advance", &o->advance, 0, 0.4},
                                   {"--collective", &o->collective, -30, 30},
                                   {"--cyclic-cos", &o->cyclic_cos, -20, 20},
                                   {"--cyclic-sin", &o->cyclic_sin, -20, 20},
                                   {"--revolutions", &o->revolutions, 10, 1000},
                                   {"--steps", &o->steps, 100, 10000}};
  if (strcmp(name, "--out") == 0) {
    return read_out(&o->out, text);
  }
  return read_number(numbers, (int)(sizeof numbers / sizeof numbers[0]), name, text);
}

static int read_options(options *o, int argc, char **argv)
{
  const int status = read_all(argc, argv, help, read_option, o);
  if (status != 0) {
    return status;
  }
  if (o->offset < 0.01 * o->radius || o->offset > 0.5 * o->radius) {
    return fail("--offset is 0.01 to 0.5 of the radius: without it nothing holds the lag hinge", "");
  }
  if (fabs(o->steps - 2 * floor(0.5 * o->steps)) > 0 || fabs(o->revolutions - floor(o->revolutions)) > 0) {
    return fail("--revolutions and --steps want whole numbers, --steps an even one", "");
  }
  return 0;
}

/* ---- rigid blades in closed form */

/* The strips reach from a fifth of the radius, or the hinge, to the tip. */
static double strip_width(const options *o)
{
  return (o->radius - fmax(o->offset, 0.2 * o->radius)) / STRIPS;
}

static double strip_radius(const options *o, int i)
{
  return o->radius - (STRIPS - i - 0.5) * strip_width(o);
}

/* A blade about its hinge, beta'' I + c beta' + I Omega^2 nu^2 beta = g_pitch theta - g_inflow V. */
typedef struct blade_numbers {
  double I, nu, c, g_pitch, g_inflow; /* [kg m^2], -, [N m s], [N m], [N s] */
} blade_numbers;

static blade_numbers closed_form(const options *o)
{
  const double L = o->radius - o->offset, S = o->mass * L * L / 2, W = o->spin;
  const double lift = 0.5 * o->density * o->chord * strip_width(o) * o->lift_slope; /* per U_T (U_T theta - U_P) */
  const double drag = 0.5 * o->density * o->chord * strip_width(o) * o->drag;
  blade_numbers b = {0};
  b.I = o->mass * L * L * L / 3;
  b.nu = sqrt(1 + o->offset * S / b.I + o->flap_spring / (b.I * W * W));
  for (int i = 0; i < STRIPS; i++) {
    const double r = strip_radius(o, i), x = r - o->offset; /* U_T = W r, U_P = x beta' + V */
    b.c += (lift + drag) * W * r * x * x;
    b.g_pitch += lift * W * W * r * r * x;
    b.g_inflow += (lift + drag) * W * r * x;
  }
  return b;
}

/* Momentum theory: thrust = 2 rho pi R^2 V^2, by bisection. */
static double hover_inflow(const options *o)
{
  const double lift = 0.5 * o->density * o->chord * strip_width(o) * o->lift_slope, W = o->spin;
  double low = 0, high = 100;
  for (int k = 0; k < 60; k++) {
    const double V = 0.5 * (low + high);
    double thrust = 0;
    for (int i = 0; i < STRIPS; i++) {
      const double r = strip_radius(o, i);
      thrust += BLADES * lift * W * r * (W * r * o->collective * degree - V);
    }
    *(thrust > 2 * o->density * pi * o->radius * o->radius * V * V ? &low : &high) = V;
  }
  return low;
}

/* Coning by the tip of a flexible blade. Under its tension T = m W^2 (R^2 - r^2)/2 and the force F of the strips
   further out its slope w obeys  EI w'' - T w + F = 0,  EI w' = k w at the hinge, w' = 0 at the tip: by finite
   differences, eliminated from the tip to the hinge. */
static double flexible_coning(const options *o)
{
  enum { N = 2000 };
  static double w[N + 1], c[N + 1], d[N + 1]; /* w_j = c_j w_(j-1) + d_j */
  const double half = 0.5 * o->density * o->chord * strip_width(o), W = o->spin, R = o->radius;
  const double h = (R - o->offset) / N, g = o->ei_flap / (h * h);
  double height = 0;
  for (int j = N; j >= 0; j--) {
    const double r = o->offset + j * h, T = 0.5 * o->mass * W * W * (R * R - r * r);
    const double spring = j == 0 ? 2 * o->flap_spring / h : 0; /* w_(-1) = w_1 - 2 h k w_0/EI */
    const double out = j == N ? 0 : j == 0 ? 2 * g : g, in = j == N ? 2 * g : j == 0 ? 0 : g;
    double F = 0;
    for (int i = 0; i < STRIPS; i++) {
      const double s = strip_radius(o, i), part = (s - r) / h + 0.5; /* of a strip within half a mesh width */
      const double lift = o->lift_slope * (W * s * o->collective * degree - o->inflow) - o->drag * o->inflow;
      F += half * W * s * lift * fmax(0, fmin(1, part));
    }
    d[j] = 2 * g + T + spring - (j < N ? out * c[j + 1] : 0);
    c[j] = in / d[j];
    d[j] = (F + (j < N ? out * d[j + 1] : 0)) / d[j];
  }
  for (int j = 0; j <= N; j++) {
    w[j] = d[j] + (j > 0 ? c[j] * w[j - 1] : 0);
    height += (j == 0 || j == N ? 0.5 : 1) * h * w[j];
  }
  return height / (R - o->offset);
}

/* ---- the model */

typedef struct fidelity { /* of a run */
  const char *name;
  int flexible, lag, air; /* 0: blades rigid, lag hinge locked, vacuum */
} fidelity;

static fb_body model[MODELS];
static fb_system rotor;
static fb_system_work work;

static void need(fb_status status, const char *what)
{
  if (status != FB_OK) {
    fprintf(stderr, "rotor: %s: %s\n", what, fb_status_string(status));
    exit(1);
  }
}

static void make_hub_and_cross(fb_shape *shape, fb_body_work *scratch)
{
  const fb_real center[3] = {0}, inertia[6] = {20, 20, 40, 0, 0, 0};
  const fb_body_desc rigid = {.base = FB_BASE_PRESCRIBED};
  need(fb_shape_init(shape, 0), "cross");
  need(fb_body_init(&model[CROSS_MODEL], scratch, shape, &rigid), "cross");
  need(fb_shape_add_rigid(shape, FB_R(100.0), center, inertia), "hub");
  need(fb_body_init(&model[HUB_MODEL], scratch, shape, &rigid), "hub");
}

/* A uniform blade along x, y toward its leading edge: two bending modes of flap, one of lag, clamped to the pitch
   bearing. */
static void make_blade(const options *o, const fidelity *f, fb_shape *shape, fb_body_work *scratch)
{
  static fb_modes_work modes_work;
  static fb_modes modes;
  static fb_beam beam;
  static fb_beam_desc desc;
  const fb_modes_desc keep = {.count = {1, 2}};
  const fb_body_desc level = {.base = FB_BASE_PRESCRIBED, .effects = f->flexible ? FB_EFFECTS_FULL : FB_EFFECTS_RIGID};
  int node;
  desc.length = (fb_real)(o->radius - o->offset);
  desc.n_element = 8;
  desc.n_station = 1;
  desc.station[0].mass = (fb_real)o->mass;
  desc.station[0].EI_y = (fb_real)o->ei_flap;
  desc.station[0].EI_z = (fb_real)o->ei_lag;
  desc.station[0].i_z = (fb_real)(o->mass * o->chord * o->chord / 12); /* a plate as wide as the chord */
  need(fb_beam_init(&beam, &desc), "blade");
  need(fb_modes_solve(&modes, &modes_work, &beam, &keep), "modes of a blade");
  need(fb_shape_init(shape, modes.n), "blade");
  need(fb_shape_add_beam(shape, 0, &beam, &modes), "blade");
  for (int i = 0; i <= STRIPS; i++) {
    const double x = i < STRIPS ? strip_radius(o, i) - o->offset : o->radius - o->offset;
    need(fb_shape_add_beam_node(shape, &node, 0, &beam, &modes, (fb_real)x), "nodes of a blade");
  }
  need(fb_body_init(&model[BLADE_MODEL], scratch, shape, &level), "blade");
}

static void turn(fb_real quat[4], double x, double y, double z)
{
  const fb_real phi[3] = {(fb_real)x, (fb_real)y, (fb_real)z};
  fb_quat_from_rotvec(quat, phi);
}

/* Hinge of blade k: its z is the shaft's (lag, forward), its x points to the trailing edge (flap, up), its y along the
   blade. */
static void make_hinge(const options *o, const fidelity *f, fb_joint_desc *hinge, int k)
{
  const double azimuth = 0.5 * pi * k;
  hinge->kind = FB_JOINT_UNIVERSAL;
  hinge->parent = 0;
  hinge->position[0] = (fb_real)(o->offset * cos(azimuth));
  hinge->position[1] = (fb_real)(o->offset * sin(azimuth));
  turn(hinge->attitude, 0, 0, azimuth - 0.5 * pi);
  turn(hinge->child_attitude, 0, 0, -0.5 * pi);
  hinge->stiffness[FLAP] = (fb_real)o->flap_spring;
  hinge->damping[LAG] = (fb_real)(f->air ? o->lag_damper : 0.0);
  hinge->mode[LAG] = f->lag ? FB_AXIS_FREE : FB_AXIS_LOCKED;
}

/* Pitch bearing: its z along the blade, nose up. */
static void make_bearing(fb_joint_desc *bearing, int k)
{
  bearing->kind = FB_JOINT_REVOLUTE;
  bearing->parent = CROSS(k);
  turn(bearing->attitude, 0, 0.5 * pi, 0);
  turn(bearing->child_attitude, 0, 0.5 * pi, 0);
  bearing->mode[0] = FB_AXIS_PRESCRIBED;
}

static void make_rotor(const options *o, const fidelity *f)
{
  static fb_shape shape;
  static fb_body_work scratch;
  static fb_system_desc desc;
  memset(&desc, 0, sizeof desc);
  make_hub_and_cross(&shape, &scratch);
  make_blade(o, f, &shape, &scratch);
  desc.n_body = 1 + 2 * BLADES;
  desc.model[0] = HUB_MODEL;
  desc.joint[0].kind = FB_JOINT_REVOLUTE;
  desc.joint[0].parent = FB_GROUND;
  desc.joint[0].mode[0] = FB_AXIS_PRESCRIBED;
  for (int k = 0; k < BLADES; k++) {
    desc.model[CROSS(k)] = CROSS_MODEL;
    desc.model[BLADE(k)] = BLADE_MODEL;
    make_hinge(o, f, &desc.joint[CROSS(k)], k);
    make_bearing(&desc.joint[BLADE(k)], k);
  }
  need(fb_system_init(&rotor, &work, model, &desc, MODELS), "system");
}

/* ---- a run */

typedef struct strip_loads {
  double force[BLADES][STRIPS][2]; /* [N] along y, z of the section */
} strip_loads;

typedef struct scene {
  const options *o;
  const fidelity *f;
  fb_system_state state;
  fb_system_input input;
  fb_system_motion motion;
  strip_loads loads, before;         /* at the beginning of this step and of the one before */
  double thrust;                     /* [N] */
  double power, moment;              /* [W] into the rotor, [N m] on it about the shaft, at this instant */
  double work, impulse;              /* [J], [N m s] since the beginning, by Simpson's rule over pairs of steps */
  double moved, turned;              /* integrals of |power|, |moment| of the shaft */
  double energy, momentum;           /* at the beginning */
  double energy_miss, momentum_miss; /* [J], [N m s] largest difference */
} scene;

/* Shaft and pitch at time t. */
static void set_drives(fb_system_input *input, const options *o, const fidelity *f, double t)
{
  const double W = o->spin, azimuth = fmod(W * t, 2 * pi), on = f->air ? degree : 0;
  input->drive[0].value[0] = (fb_real)azimuth;
  input->drive[0].rate[0] = (fb_real)W;
  for (int k = 0; k < BLADES; k++) {
    fb_drive *pitch = &input->drive[BLADE(k)];
    const double c = cos(azimuth + 0.5 * pi * k), s = sin(azimuth + 0.5 * pi * k);
    const double wave = on * (o->cyclic_cos * c + o->cyclic_sin * s);
    pitch->value[0] = (fb_real)(on * o->collective + wave);
    pitch->rate[0] = (fb_real)(W * on * (o->cyclic_sin * c - o->cyclic_cos * s));
    pitch->acceleration[0] = (fb_real)(-W * W * wave);
  }
}

/* The loads `ahead` of a step after this instant, by the straight line through the last two instants: the stepper takes
   loads as functions of time, and held ones would lag behind the motion that causes them. */
static void set_loads(fb_system_input *input, const scene *s, double ahead)
{
  input->n_load = s->f->air ? BLADES * STRIPS : 0;
  for (int k = 0; k < input->n_load; k++) {
    const double *now = s->loads.force[k / STRIPS][k % STRIPS], *before = s->before.force[k / STRIPS][k % STRIPS];
    input->load[k].body = BLADE(k / STRIPS);
    input->load[k].load.node = 1 + k % STRIPS;
    input->load[k].load.axes = FB_AXES_NODE;
    for (int i = 0; i < 2; i++) {
      input->load[k].load.force[1 + i] = (fb_real)(now[i] + ahead * (now[i] - before[i]));
    }
  }
}

static void node_motion(fb_node_motion *at, const scene *s, int blade, int node)
{
  const int body = BLADE(blade);
  need(fb_body_node_motion_eval(&model[BLADE_MODEL], at, &s->motion.pose[body], &s->motion.motion[body], node), "node");
}

/* A thin airfoil that moves with u = (u_y, u_z) through the air has the circulation Gamma = -a c u_z / 2; lift
   rho Gamma (-u_z, u_y), drag against u. */
static void strip_force(double force[2], const options *o, const fb_node_motion *at)
{
  const double wind[3] = {o->advance * o->spin * o->radius, 0, -o->inflow};
  const double half = 0.5 * o->density * o->chord * strip_width(o);
  fb_real R[9], air[3], u[3];
  double y, z, speed;
  fb_quat_to_mat33(R, at->quat);
  for (int i = 0; i < 3; i++) {
    air[i] = at->velocity[i] - (fb_real)wind[i];
  }
  fb_mat33_mulT_vec3(u, R, air);
  y = (double)u[1];
  z = (double)u[2];
  speed = sqrt(y * y + z * z);
  force[0] = half * (o->lift_slope * z * z - o->drag * speed * y);
  force[1] = half * (-o->lift_slope * z * y - o->drag * speed * z);
}

/* Motion, loads and balances at time t; the loads follow from velocities, which do not depend on them. */
static void look(scene *s, double t)
{
  fb_node_motion at;
  set_drives(&s->input, s->o, s->f, t);
  need(fb_system_motion_eval(&rotor, model, &work, &s->motion, &s->state, &s->input), "motion");
  s->thrust = s->power = s->moment = 0;
  for (int k = 0; k < BLADES && s->f->air; k++) {
    const double lag = (double)s->motion.joint[CROSS(k)].speed[LAG];
    s->power -= s->o->lag_damper * lag * lag;
    for (int i = 0; i < STRIPS; i++) {
      double *force = s->loads.force[k][i];
      fb_real R[9], F[3], local[3] = {0}, moment[3];
      node_motion(&at, s, k, 1 + i);
      strip_force(force, s->o, &at);
      local[1] = (fb_real)force[0];
      local[2] = (fb_real)force[1];
      fb_quat_to_mat33(R, at.quat);
      fb_mat33_mul_vec3(F, R, local);
      fb_vec3_cross(moment, at.position, F);
      s->thrust += (double)F[2];
      s->power += (double)fb_vec3_dot(F, at.velocity);
      s->moment += (double)moment[2];
    }
  }
  set_loads(&s->input, s, 0);
  need(fb_system_motion_eval(&rotor, model, &work, &s->motion, &s->state, &s->input), "motion");
  s->power += (double)s->motion.power;
  s->moment += (double)s->motion.joint[0].torque[2];
}

static void totals(const scene *s, double *energy, double *momentum)
{
  fb_energy e;
  fb_momentum m;
  need(fb_system_energy_eval(&rotor, model, &work, &e, &s->state, &s->input), "energy");
  need(fb_system_momentum_eval(&rotor, model, &work, &m, &s->state, &s->input), "momentum");
  *energy = (double)(e.kinetic + e.strain);
  *momentum = (double)m.angular[2];
}

/* Turning, all blades raised by flap [rad]. */
static void begin(scene *s, const options *o, const fidelity *f, double flap)
{
  static fb_link_motion start[1 + 2 * BLADES];
  memset(s, 0, sizeof *s);
  memset(start, 0, sizeof start);
  s->o = o;
  s->f = f;
  set_drives(&s->input, o, f, 0);
  start[0].speed[0] = s->input.drive[0].rate[0];
  for (int k = 0; k < BLADES; k++) {
    start[CROSS(k)].value[FLAP] = (fb_real)flap;
    start[BLADE(k)].value[0] = s->input.drive[BLADE(k)].value[0];
    start[BLADE(k)].speed[0] = s->input.drive[BLADE(k)].rate[0];
  }
  need(fb_system_state_init(&rotor, model, &s->state, &work, start, &s->input), "initial state");
  look(s, 0);
  s->before = s->loads;
  totals(s, &s->energy, &s->momentum);
}

static void advance(scene *s, double t, double dt)
{
  static fb_system_input middle, end;
  middle = end = s->input;
  set_drives(&middle, s->o, s->f, t + 0.5 * dt);
  set_drives(&end, s->o, s->f, t + dt);
  set_loads(&middle, s, 0.5);
  set_loads(&end, s, 1);
  need(fb_system_rk4_step(&rotor, model, &s->state, &work, &s->input, &middle, &end, (fb_real)dt), "step");
  s->before = s->loads;
  look(s, t + dt);
}

/* Step number k of a run, k = 0, 1, ..; balances after every second one. */
static void step(scene *s, int k)
{
  const double dt = 2 * pi / (s->o->spin * s->o->steps);
  s->work += (k % 2 ? 4 : 1) * dt / 3 * s->power;
  s->impulse += (k % 2 ? 4 : 1) * dt / 3 * s->moment;
  s->moved += dt * fabs((double)s->motion.joint[0].drive[0]) * s->o->spin;
  s->turned += dt * fabs((double)s->motion.joint[0].drive[0]);
  advance(s, k * dt, dt);
  if (k % 2) {
    double energy, momentum;
    s->work += dt / 3 * s->power;
    s->impulse += dt / 3 * s->moment;
    totals(s, &energy, &momentum);
    s->energy_miss = fmax(s->energy_miss, fabs(energy - s->energy - s->work));
    s->momentum_miss = fmax(s->momentum_miss, fabs(momentum - s->momentum - s->impulse));
  }
}

/* ---- what is seen */

typedef struct disc { /* [rad] multiblade coordinates */
  double coning, tilt_cos, tilt_sin, differential;
} disc;

/* Flap of the blades by the height of their tips. */
static disc look_at_disc(const scene *s, double azimuth)
{
  disc d = {0};
  for (int k = 0; k < BLADES; k++) {
    const double psi = azimuth + 0.5 * pi * k;
    fb_node_motion tip;
    double beta;
    node_motion(&tip, s, k, TIP);
    beta = (double)tip.position[2] / (s->o->radius - s->o->offset);
    d.coning += beta / BLADES;
    d.tilt_cos += 2 * beta * cos(psi) / BLADES;
    d.tilt_sin += 2 * beta * sin(psi) / BLADES;
    d.differential += (k % 2 ? -beta : beta) / BLADES;
  }
  return d;
}

/* Flap frequency in vacuum, per revolution: upward zero crossings of the coning of raised blades. */
static double flap_frequency(const options *o, const fidelity *f)
{
  static scene s;
  const int steps = (int)(o->steps * o->revolutions);
  double last, first_time = -1, last_time = -1;
  int crossings = 0;
  make_rotor(o, f);
  begin(&s, o, f, 0.5 * degree);
  last = look_at_disc(&s, 0).coning;
  for (int k = 0; k < steps; k++) {
    double now;
    step(&s, k);
    now = look_at_disc(&s, 0).coning;
    if (last < 0 && now >= 0) {
      last_time = (k + last / (last - now)) / o->steps;
      first_time = first_time < 0 ? last_time : first_time;
      crossings++;
    }
    last = now;
  }
  return crossings > 1 ? (crossings - 1) / (last_time - first_time) : 0;
}

typedef struct answer {
  disc disc;                         /* mean over the last revolution */
  double lag, thrust, torque;        /* [rad], [N], [N m] the same */
  double gain, phase;                /* of the tilt to the cyclic pitch, [rad] behind it */
  double energy_miss, momentum_miss; /* relative to the shaft's work and angular impulse */
} answer;

static void print_row(FILE *file, const scene *s, double t)
{
  const disc d = look_at_disc(s, fmod(s->o->spin * t, 2 * pi));
  const fb_joint_motion *hinge = &s->motion.joint[CROSS(0)];
  fb_node_motion tip;
  node_motion(&tip, s, 0, TIP);
  fprintf(file, "%.8g,%.8g,%.8g,%.8g,%.8g,%.8g,%.8g,%.8g,%.8g,%.8g,%.8g,%.8g\n", t, d.coning / degree,
          d.tilt_cos / degree, d.tilt_sin / degree, d.differential / degree,
          (double)s->motion.joint[BLADE(0)].value[0] / degree, (double)hinge->value[FLAP] / degree,
          (double)hinge->value[LAG] / degree, (double)tip.displacement[2], (double)tip.displacement[1], s->thrust,
          (double)s->motion.joint[0].drive[0]);
}

/* Tilt by cyclic pitch, both as complex amplitudes c - i s of exp(i psi). */
static void relate(answer *a, const options *o)
{
  const double pitch = hypot(o->cyclic_cos, o->cyclic_sin) * degree;
  const double lead = atan2(-a->disc.tilt_sin, a->disc.tilt_cos) - atan2(-o->cyclic_sin, o->cyclic_cos);
  a->gain = pitch > 0 ? hypot(a->disc.tilt_cos, a->disc.tilt_sin) / pitch : 0;
  a->phase = pitch > 0 ? -atan2(sin(lead), cos(lead)) : 0;
}

static answer respond(const options *o, const fidelity *f, FILE *file)
{
  static scene s;
  const int per_turn = (int)o->steps, steps = (int)o->revolutions * per_turn, stride = 1 + steps / MAX_ROWS;
  answer a = {0};
  make_rotor(o, f);
  begin(&s, o, f, 0);
  for (int k = 0; k < steps; k++) {
    if (file && k % stride == 0) {
      print_row(file, &s, k * 2 * pi / (o->spin * o->steps));
    }
    step(&s, k);
    if (k >= steps - per_turn) {
      const disc d = look_at_disc(&s, 2 * pi * ((k + 1) % per_turn) / per_turn);
      a.disc.coning += d.coning / per_turn;
      a.disc.tilt_cos += d.tilt_cos / per_turn;
      a.disc.tilt_sin += d.tilt_sin / per_turn;
      a.disc.differential += d.differential / per_turn;
      a.lag += (double)s.motion.joint[CROSS(0)].value[LAG] / per_turn;
      a.thrust += s.thrust / per_turn;
      a.torque += (double)s.motion.joint[0].drive[0] / per_turn;
    }
  }
  relate(&a, o);
  a.energy_miss = s.energy_miss / s.moved;
  a.momentum_miss = s.momentum_miss / s.turned;
  return a;
}

/* The same of rigid blades with the lag hinge locked: beta_1 = g theta_1 / (I Omega^2 (nu^2 - 1) + i c Omega). */
static answer expected(const options *o)
{
  const blade_numbers b = closed_form(o);
  const double W = o->spin, re = b.I * W * W * (b.nu * b.nu - 1), im = b.c * W, size = b.g_pitch / (re * re + im * im);
  const double c = o->cyclic_cos * degree, s = o->cyclic_sin * degree; /* (c - i s)(re - i im) */
  answer a = {0};
  a.disc.coning = (b.g_pitch * o->collective * degree - b.g_inflow * o->inflow) / (b.I * W * W * b.nu * b.nu);
  a.disc.tilt_cos = size * (c * re - s * im);
  a.disc.tilt_sin = size * (s * re + c * im);
  relate(&a, o);
  return a;
}

static void print_answer(const char *name, const answer *a, int measured)
{
  printf("  %-34s %8.4f %8.4f %8.4f %9.4f %8.3f", name, a->disc.coning / degree, a->disc.tilt_cos / degree,
         a->disc.tilt_sin / degree, a->gain, a->phase / degree);
  if (measured) {
    printf(" %8.3f %9.0f %9.0f", a->lag / degree, a->thrust, a->torque);
  }
  puts("");
}

static void draw(const char *csv)
{
  char svg[512];
  const curve curves[] = {{csv, "1:2", "every ::1 with lines lw 2 lc rgb '#0060ad'", "coning"},
                          {csv, "1:3", "every ::1 with lines lw 2 lc rgb '#dd181f'", "tilt, cosine"},
                          {csv, "1:4", "every ::1 with lines lw 2 lc rgb '#009e73'", "tilt, sine"},
                          {csv, "1:7", "every ::1 with lines lw 1 lc rgb '#888888'", "flap hinge of a blade"},
                          {csv, "1:8", "every ::1 with lines lw 1 lc rgb '#e69f00'", "lag hinge of a blade"}};
  other_name(svg, sizeof svg, csv, ".svg");
  plot(
      svg,
      "set key below\nset ylabel 'angle [deg]'\nset title 'A rotor from straight blades to its steady cone and tilt'\n",
      curves, 5, stdout);
}

static int misses;

static void check(const char *what, double got, double bound)
{
  printf("  %-62s %10.3g  below %8.3g  %s\n", what, got, bound, fabs(got) < bound ? "ok" : "FAILED");
  misses += !(fabs(got) < bound);
}

static const fidelity fidelities[] = {
    {"rigid blades, lag locked", 0, 0, 1}, {"rigid blades", 0, 1, 1}, {"flexible blades", 1, 1, 1}};
#define FIDELITIES ((int)(sizeof fidelities / sizeof fidelities[0]))

static void compare_frequencies(const options *o)
{
  const fidelity rigid = {"", 0, 0, 0}, flexible = {"", 1, 0, 0};
  const double nu = closed_form(o).nu, stiff = flap_frequency(o, &rigid), soft = flap_frequency(o, &flexible);
  printf("flap frequency in vacuum, per revolution: closed form %.5f, rigid blades %.5f, flexible blades %.5f\n", nu,
         stiff, soft);
  check("flap frequency of rigid blades, off the closed form by", stiff / nu - 1, 5e-4);
  check("flap frequency of flexible blades, off the closed form by", soft / nu - 1, 2e-2);
}

/* Rigid blades with the lag hinge locked are the closed form but for squares of the angles: some 0.5 % at 8 degrees.
   Soft blades bend upward under lift that grows outward, which adds to the coning, and hardly to the tilt. */
static void compare_answers(const options *o, const answer *all)
{
  const answer e = expected(o);
  const double bent = flexible_coning(o);
  print_answer("rigid blades, closed form", &e, 0);
  printf("  %-34s %8.4f\n", "flexible blades, beam in tension", bent / degree);
  for (int k = 0; k < FIDELITIES; k += FIDELITIES - 1) {
    const double part = k ? 0.05 : 0.015, miss = all[k].phase - e.phase;
    printf("%s\n", fidelities[k].name);
    if (fabs(e.disc.coning) > 0.1 * degree) {
      check("coning, off by", all[k].disc.coning / (k ? bent : e.disc.coning) - 1, part);
    }
    if (e.gain > 0) {
      check("gain from cyclic pitch to tilt, off that of rigid blades by", all[k].gain / e.gain - 1, part);
      check("phase, off that of rigid blades by [deg]", atan2(sin(miss), cos(miss)) / degree, k ? 5 : 0.5);
    }
  }
}

int main(int argc, char **argv)
{
  options o = {44,   5,     0.25,     5.5, 9000, 130000, 0, 2000, 0.27, 5.7,
               0.01, 1.225, HUGE_VAL, 0,   8,    0,      2, 30,   360,  "rotor.csv"};
  answer all[FIDELITIES];
  FILE *file;
  int bad;
  output_begin(PROGRAM);
  bad = read_options(&o, argc, argv);
  if (bad) {
    return bad;
  }
  o.inflow = isfinite(o.inflow) ? o.inflow : hover_inflow(&o);
  file = fopen(o.out, "w");
  if (!file) {
    return fail("cannot write", o.out);
  }
  fputs("t,coning_deg,tilt_cos_deg,tilt_sin_deg,differential_deg,pitch_deg,flap_deg,lag_deg,tip_flap,tip_lag,thrust,"
        "torque\n",
        file);
  compare_frequencies(&o);
  printf("answer to collective %.3g deg, cyclic %.3g deg cosine, %.3g deg sine; inflow %.3f m/s; last revolution\n",
         o.collective, o.cyclic_cos, o.cyclic_sin, o.inflow);
  printf("  %-34s %8s %8s %8s %9s %8s %8s %9s %9s\n", "", "coning", "cosine", "sine", "gain", "behind", "lag", "thrust",
         "torque");
  for (int k = 0; k < FIDELITIES; k++) {
    all[k] = respond(&o, &fidelities[k], k == FIDELITIES - 1 ? file : NULL);
    print_answer(fidelities[k].name, &all[k], 1);
  }
  if (output_close(file, o.out)) {
    return 2;
  }
  if (!(o.advance > 0)) {
    compare_answers(&o, all);
  }
  printf("balances, flexible blades\n");
  check("energy less work, part of the shaft's work", all[FIDELITIES - 1].energy_miss, FB_SINGLE ? 1e-3 : 1e-5);
  check("angular momentum less impulse, part of the shaft's", all[FIDELITIES - 1].momentum_miss,
        FB_SINGLE ? 1e-3 : 1e-5);
  printf("curves: %s\n", o.out);
  draw(o.out);
  return misses != 0;
}
