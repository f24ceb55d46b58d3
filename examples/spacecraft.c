/* spacecraft - a slew with flexible solar arrays, without and with a notch filter in the attitude loop.
   A free hub carries two arrays on drives, along +y and -y of the hub. Gyros and a star tracker on the hub feed a PD
   controller, whose torque command passes a roll-off filter (it keeps the noise of the sensors off the wheels) and, in
   the second run, a notch at the frequency at which hub and arrays swing against each other. The roll-off turns the
   phase at that frequency so far that the loop feeds the arrays; without the notch they swing until the torque limit
   stops them.
   Checks: that frequency, in closed form and as the model swings; angular momentum against the impulse of the torque;
   energy against work and dissipation; the error at the end with the notch, and the arrays' residual swing.
   Exit: 0 well, 1 a check failed or the motion left the model, 2 bad options or a file that cannot be written. */
#define _POSIX_C_SOURCE 200809L /* popen, for gnuplot */
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#define PROGRAM "spacecraft"
#include "common/filter.h"
#include "common/options.h"
#include "common/output.h"
#include "common/plot.h"
#include "common/solar_array.h"

#define MAX_ROWS 4096
#define PERIOD 0.01 /* [s] of the controller */
static const double pi = 3.14159265358979324, degree = 3.14159265358979324 / 180.0;

enum { HUB, RIGHT, LEFT, BODIES };               /* of the system */
enum { HUB_MODEL, ARRAY_MODEL, MODELS };         /* the arrays share one */
enum { DRIVE_RATE, DRIVE_LOCKED, DRIVE_SPRING }; /* what the array drives do */

typedef struct options {
  double angle, slew, t_end, bandwidth, roll_off, notch, limit, damping, drive_rate, array_mass, frequency, dt;
  int drive;
  const char *out;
} options;

static const char help[] =
    "spacecraft - slew of a hub with two flexible solar arrays, without and with a notch filter\n"
    "usage: spacecraft [options]\n"
    "  --angle A        [deg] slew about x of the hub (30)\n"
    "  --slew T         [s] its duration; the rate is a versine, 1 - cos(2 pi t/T) (40)\n"
    "  --t-end T        [s] end of the runs (120)\n"
    "  --bandwidth W    [rad/s] of the attitude loop, damping ratio 0.8 (0.4)\n"
    "  --roll-off F     [Hz] corner of the roll-off filter, second order (0.4)\n"
    "  --notch R        center of the notch, relative to the frequency it is for (1; too low is forgiven)\n"
    "  --limit T        [N m] torque limit per axis (10)\n"
    "  --frequency F    [Hz] first bending of a clamped array, out of its plane (0.25)\n"
    "  --array-mass M   [kg] of one array of 8 m by 2 m (30)\n"
    "  --damping Z      damping ratio of the arrays' modes (0.005)\n"
    "  --drive rate|locked|spring  the array drives turn, stand, or give way (rate)\n"
    "  --drive-rate W   [deg/s] rate of --drive rate (0.06, as in low orbit)\n"
    "  --dt DT          [s] step, a fraction of the control period of 0.01 s (0.002)\n"
    "  --out FILE       CSV of both runs; beside it two pictures (SVG) when gnuplot is there (spacecraft.csv)\n"
    "  --help           this text\n"
    "The checks at the end are those of a controller that fits its craft: one that does not fails them.\n";

static int read_option(void *target, const char *name, const char *text)
{
  options *const o = target;
  const number_option numbers[] = {
      {"--angle", &o->angle, -180, 180},           {"--slew", &o->slew, 1e-3, 1e4},
      {"--t-end", &o->t_end, 1e-3, 1e4},           {"--bandwidth", &o->bandwidth, 1e-6, 1e3},
      {"--roll-off", &o->roll_off, 1e-6, 20},      {"--notch", &o->notch, 1e-3, 1e3},
      {"--limit", &o->limit, 1e-9, 1e9},           {"--frequency", &o->frequency, 1e-3, 1e3},
      {"--array-mass", &o->array_mass, 1e-6, 1e4}, {"--damping", &o->damping, 0, 0.999},
      {"--drive-rate", &o->drive_rate, -360, 360}, {"--dt", &o->dt, 1e-6, 1}};
  if (strcmp(name, "--drive") == 0) {
    return read_choice(&o->drive, name, text, "rate|locked|spring");
  }
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
  if (fabs(PERIOD / o->dt - floor(PERIOD / o->dt + 0.5)) > 1e-6 * PERIOD / o->dt) {
    return fail("--dt must divide the control period of 0.01 s", "");
  }
  if (fabs(o->angle) < 1e-3) {
    return fail("--angle is at least 0.001 either way", "");
  }
  if (o->t_end < o->slew + 20) {
    return fail("--t-end is at least 20 s after the slew", "");
  }
  return 0;
}

/* ---- the model */

static const double hub_mass = 1200, hub_inertia[3] = {1000, 800, 1100}; /* [kg], [kg m^2] */
static const double drive_stiffness = 500, drive_damping = 5;            /* [N m/rad], [N m s/rad] of --drive spring */

static fb_beam beam;
static fb_modes modes;
static fb_body model[MODELS];
static fb_system craft;
static fb_system_work work;
static int tip; /* node of the arrays */

static void need(fb_status status, const char *what)
{
  if (status != FB_OK) {
    fprintf(stderr, "spacecraft: %s: %s\n", what, fb_status_string(status));
    exit(1);
  }
}

static solar_array array_of(const options *o)
{
  const solar_array a = {8, 2, 1, o->array_mass, o->frequency, o->damping, 0};
  return a;
}

static void make_hub(fb_shape *shape, fb_body_work *scratch)
{
  const fb_real center[3] = {0};
  const fb_real inertia[6] = {(fb_real)hub_inertia[0], (fb_real)hub_inertia[1], (fb_real)hub_inertia[2], 0, 0, 0};
  const fb_body_desc rigid = {.base = FB_BASE_PRESCRIBED};
  need(fb_shape_init(shape, 0), "hub");
  need(fb_shape_add_rigid(shape, (fb_real)hub_mass, center, inertia), "hub");
  need(fb_body_init(&model[HUB_MODEL], scratch, shape, &rigid), "hub");
}

static void make_drive(const options *o, fb_joint_desc *joint, int body)
{
  const solar_array a = array_of(o);
  solar_array_hang(joint, &a, body == RIGHT ? 1 : -1);
  joint->mode[0] = o->drive == DRIVE_RATE     ? FB_AXIS_PRESCRIBED
                   : o->drive == DRIVE_LOCKED ? FB_AXIS_LOCKED
                                              : FB_AXIS_FREE;
  joint->stiffness[0] = (fb_real)(o->drive == DRIVE_SPRING ? drive_stiffness : 0);
  joint->damping[0] = (fb_real)(o->drive == DRIVE_SPRING ? drive_damping : 0);
}

static void make_craft(const options *o)
{
  static fb_shape shape;
  static fb_body_work scratch;
  static fb_system_desc desc;
  const solar_array a = array_of(o);
  make_hub(&shape, &scratch);
  need(solar_array_init(&model[ARRAY_MODEL], &tip, &beam, &modes, &a), "array");
  desc.n_body = BODIES;
  desc.model[HUB] = HUB_MODEL;
  desc.joint[HUB].kind = FB_JOINT_FREE;
  desc.joint[HUB].parent = FB_GROUND;
  for (int k = RIGHT; k <= LEFT; k++) {
    desc.model[k] = ARRAY_MODEL;
    make_drive(o, &desc.joint[k], k);
  }
  need(fb_system_init(&craft, &work, model, &desc, MODELS), "system");
}

/* Moments of inertia of the whole about the hub's axes, undeformed. */
static void inertia_of_whole(const options *o, double J[3])
{
  const solar_array a = array_of(o);
  memcpy(J, hub_inertia, 3 * sizeof J[0]);
  solar_array_add_inertia(J, &a);
}

static double swing_frequency(const options *o)
{
  const solar_array a = array_of(o);
  double J[3];
  inertia_of_whole(o, J);
  return solar_array_swing(&modes, &a, J[0]);
}

/* ---- the controller */

typedef struct controller {
  double J[3], kp[3], kd[3], limit; /* [kg m^2], [N m/rad], [N m s/rad], [N m] */
  int with_notch;
  filter roll_off[3], notch[3];
} controller;

static void controller_init(controller *c, const options *o, int with_notch)
{
  const double r = 2 * pi * o->roll_off, w = o->notch * swing_frequency(o);
  memset(c, 0, sizeof *c);
  inertia_of_whole(o, c->J);
  c->limit = o->limit;
  c->with_notch = with_notch;
  for (int i = 0; i < 3; i++) {
    c->kp[i] = c->J[i] * o->bandwidth * o->bandwidth;
    c->kd[i] = 2 * 0.8 * c->J[i] * o->bandwidth;
    filter_init(&c->roll_off[i], 0, 0, r * r, 2 * 0.7 * r, r * r, r, PERIOD);
    filter_init(&c->notch[i], 1, 2 * 0.02 * w, w * w, 2 * 0.5 * w, w * w, w, PERIOD);
  }
}

/* Where the slew should be: angle, rate and acceleration about x. */
static void profile(const options *o, double t, double slew[3])
{
  const double angle = o->angle * degree, x = 2 * pi * t / o->slew;
  slew[0] = t < o->slew ? angle * (t / o->slew - sin(x) / (2 * pi)) : angle;
  slew[1] = t < o->slew ? angle * (1 - cos(x)) / o->slew : 0;
  slew[2] = t < o->slew ? angle * 2 * pi * sin(x) / (o->slew * o->slew) : 0;
}

/* Small rotation [rad] from where the hub should be to where it is, body axes: 2 vec(conj(q_ref) o q). */
static void pointing_error(const options *o, double t, const fb_real quat[4], double error[3])
{
  double slew[3];
  fb_real back[3] = {0}, inverse[4], e[4];
  profile(o, t, slew);
  back[0] = (fb_real)-slew[0];
  fb_quat_from_rotvec(inverse, back);
  fb_quat_mul(e, inverse, quat);
  for (int i = 0; i < 3; i++) {
    error[i] = (e[0] < 0 ? -2 : 2) * (double)e[i + 1];
  }
}

/* Torque command of the next period [N m]. */
static void controller_step(controller *c, const options *o, double t, const fb_real quat[4], const fb_imu *imu,
                            double torque[3])
{
  double slew[3], error[3];
  profile(o, t, slew);
  pointing_error(o, t, quat, error);
  for (int i = 0; i < 3; i++) {
    const double rate = (double)imu->angular_rate[i] - (i == 0 ? slew[1] : 0);
    double u = (i == 0 ? c->J[0] * slew[2] : 0) - c->kp[i] * error[i] - c->kd[i] * rate;
    u = filter_step(&c->roll_off[i], u);
    u = c->with_notch ? filter_step(&c->notch[i], u) : u;
    torque[i] = u > c->limit ? c->limit : u < -c->limit ? -c->limit : u;
  }
}

/* ---- a run */

typedef struct history {
  int rows;
  double t[MAX_ROWS], error[MAX_ROWS], tip[2][MAX_ROWS], torque[MAX_ROWS]; /* [s], [rad], [m], [N m] about x */
  double momentum_miss, energy_miss; /* largest, relative to all torque and power that the wheels gave */
  double work, lost;                 /* [J] of the torque, dissipated */
} history;

typedef struct flow { /* [W] at an instant */
  double torque, drives, lost;
} flow;

typedef struct scene {
  fb_system_state state;
  fb_system_input input;
  fb_system_motion motion;
  double energy, momentum[3];         /* at the beginning */
  double impulse[3], work, fed, lost; /* since then: of the torque, of the drives, in modes and dampers */
  double turned, passed;              /* [N m s], [J] integrals of |torque| and |its power| */
} scene;

static void look(scene *s)
{
  need(fb_system_motion_eval(&craft, model, &work, &s->motion, &s->state, &s->input), "motion");
}

/* Torque on the hub, in its axes, and where the drives are at time t. */
static void set_input(scene *s, fb_system_input *input, const options *o, double t, const double torque[3])
{
  *input = s->input;
  input->n_load = 1;
  input->load[0].body = HUB;
  input->load[0].load.axes = FB_AXES_BODY;
  for (int i = 0; i < 3; i++) {
    input->load[0].load.torque[i] = (fb_real)torque[i];
  }
  for (int k = RIGHT; k <= LEFT && o->drive == DRIVE_RATE; k++) {
    const double rate = (k == RIGHT ? 1 : -1) * o->drive_rate * degree; /* both turn the same way about y of the hub */
    input->drive[k].value[0] = (fb_real)(rate * t);
    input->drive[k].rate[0] = (fb_real)rate;
  }
}

/* The hub at rest where the slew begins, the drives turning; deflected: the arrays bent by 0.05 m at the tips. */
static void begin(scene *s, const options *o, int deflected)
{
  static fb_link_motion start[BODIES];
  const double none[3] = {0};
  fb_energy e;
  fb_momentum m;
  memset(s, 0, sizeof *s);
  memset(start, 0, sizeof start);
  set_input(s, &s->input, o, 0, none);
  for (int k = RIGHT; k <= LEFT; k++) {
    start[k].speed[0] = s->input.drive[k].rate[0];
    for (int a = 0; a < modes.n && deflected; a++) { /* the lowest out of plane, the arrays against each other */
      if (modes.kind[a] == FB_KIND_BEND_Z) {
        start[k].q[a] = (k == RIGHT ? FB_R(0.05) : FB_R(-0.05)) / model[ARRAY_MODEL].node[tip].psi[3 * a + 2];
        break;
      }
    }
  }
  need(fb_system_state_init(&craft, model, &s->state, &work, start, &s->input), "initial state");
  need(fb_system_energy_eval(&craft, model, &work, &e, &s->state, &s->input), "energy");
  need(fb_system_momentum_eval(&craft, model, &work, &m, &s->state, &s->input), "momentum");
  s->energy = (double)(e.kinetic + e.strain);
  for (int i = 0; i < 3; i++) {
    s->momentum[i] = (double)m.angular[i];
  }
  look(s);
}

/* What comes in and what is lost: modes with 2 zeta omega q_dot^2, dampers of the drives. */
static flow flow_at(const scene *s, const options *o)
{
  flow f = {0, (double)s->motion.power, 0};
  for (int i = 0; i < 3; i++) {
    f.torque += (double)(s->input.load[0].load.torque[i] * s->motion.motion[HUB].w[i]);
  }
  for (int k = RIGHT; k <= LEFT; k++) {
    const double turn = (double)s->motion.joint[k].speed[0];
    f.lost += (o->drive == DRIVE_SPRING ? drive_damping : 0) * turn * turn;
    for (int a = 0; a < modes.n; a++) {
      const double q_dot = (double)s->motion.motion[k].q_dot[a];
      f.lost += 2 * o->damping * (double)modes.omega[a] * q_dot * q_dot;
    }
  }
  return f;
}

/* Adds weight R(q) torque, the hub's torque in inertial axes. */
static void add_impulse(scene *s, const fb_real quat[4], const double torque[3], double weight)
{
  fb_real R[9];
  fb_quat_to_mat33(R, quat);
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      s->impulse[i] += weight * (double)R[3 * i + j] * torque[j];
    }
  }
}

/* One step with the torque held; impulse by Simpson's rule, work by the trapezoidal one. */
static void advance(scene *s, const options *o, double t, const double torque[3])
{
  static fb_system_input middle, end;
  const double dt = o->dt;
  fb_real before[4], between[4];
  flow f, g;
  memcpy(before, s->state.link[HUB].quat, sizeof before);
  f = flow_at(s, o);
  set_input(s, &middle, o, t + 0.5 * dt, torque);
  set_input(s, &end, o, t + dt, torque);
  need(fb_system_rk4_step(&craft, model, &s->state, &work, &s->input, &middle, &end, (fb_real)dt), "step");
  s->input = end;
  look(s);
  g = flow_at(s, o);
  s->work += 0.5 * dt * (f.torque + g.torque);
  s->fed += 0.5 * dt * (f.drives + g.drives);
  s->lost += 0.5 * dt * (f.lost + g.lost);
  for (int i = 0; i < 4; i++) {
    between[i] = before[i] + s->state.link[HUB].quat[i];
  }
  need(fb_quat_normalize(between), "attitude");
  add_impulse(s, before, torque, dt / 6);
  add_impulse(s, between, torque, dt * 4 / 6);
  add_impulse(s, s->state.link[HUB].quat, torque, dt / 6);
  s->passed += 0.5 * dt * fabs(f.torque + g.torque);
  s->turned += dt * sqrt(torque[0] * torque[0] + torque[1] * torque[1] + torque[2] * torque[2]);
}

/* How far energy and angular momentum are from what went in. */
static void balance(scene *s, history *h)
{
  fb_energy e;
  fb_momentum m;
  double miss = 0;
  need(fb_system_energy_eval(&craft, model, &work, &e, &s->state, &s->input), "energy");
  need(fb_system_momentum_eval(&craft, model, &work, &m, &s->state, &s->input), "momentum");
  for (int i = 0; i < 3; i++) {
    miss = fmax(miss, fabs((double)m.angular[i] - s->momentum[i] - s->impulse[i]));
  }
  h->momentum_miss = fmax(h->momentum_miss, miss);
  miss = (double)(e.kinetic + e.strain) - s->energy - s->work - s->fed + s->lost;
  h->energy_miss = fmax(h->energy_miss, fabs(miss));
}

static double tip_deflection(const scene *s, int body)
{
  fb_node_motion at;
  need(fb_body_node_motion_eval(&model[ARRAY_MODEL], &at, &s->motion.pose[body], &s->motion.motion[body], tip), "tip");
  return (double)at.displacement[2];
}

static void record(history *h, const scene *s, const options *o, double t, const double torque[3])
{
  double error[3];
  const int k = h->rows++;
  pointing_error(o, t, s->motion.pose[HUB].quat, error);
  h->t[k] = t;
  h->error[k] = sqrt(error[0] * error[0] + error[1] * error[1] + error[2] * error[2]);
  h->tip[0][k] = tip_deflection(s, RIGHT);
  h->tip[1][k] = tip_deflection(s, LEFT);
  h->torque[k] = torque[0];
}

static void run(history *h, const options *o, int with_notch)
{
  static scene s;
  static controller c;
  const int steps = (int)(PERIOD / o->dt + 0.5), periods = (int)(o->t_end / PERIOD + 0.5);
  const int stride = 10 * (1 + periods / (10 * (MAX_ROWS - 2)));
  memset(h, 0, sizeof *h);
  controller_init(&c, o, with_notch);
  begin(&s, o, 0);
  for (int k = 0; k <= periods; k++) {
    const double t = k * PERIOD;
    fb_node_motion sensors;
    fb_imu imu;
    double torque[3];
    need(fb_body_node_motion_eval(&model[HUB_MODEL], &sensors, &s.motion.pose[HUB], &s.motion.motion[HUB], 0),
         "sensors");
    fb_imu_eval(&imu, &sensors, NULL);
    controller_step(&c, o, t, sensors.quat, &imu, torque);
    if (k % stride == 0) {
      record(h, &s, o, t, torque);
      balance(&s, h);
    }
    set_input(&s, &s.input, o, t, torque);
    look(&s); /* the power of the drives is that with the new torque */
    for (int i = 0; i < steps && k < periods; i++) {
      advance(&s, o, t + i * o->dt, torque);
    }
  }
  h->momentum_miss /= s.turned;
  h->energy_miss /= s.passed;
  h->work = s.work;
  h->lost = s.lost;
}

/* The frequency [rad/s] at which the free craft swings: between the first and the last upward crossing of the tips'
   difference, in ten periods of a clamped array; the drives stand. */
static double measured_swing(const options *given)
{
  static scene s;
  options standing = *given;
  const options *const o = &standing;
  const double none[3] = {0};
  double last = 0, first_time = -1, last_time = -1;
  int crossings = 0;
  standing.drive_rate = 0;
  begin(&s, o, 1);
  last = tip_deflection(&s, RIGHT) - tip_deflection(&s, LEFT);
  for (int k = 0; k * o->dt < 10 / o->frequency; k++) {
    double now;
    advance(&s, o, k * o->dt, none);
    now = tip_deflection(&s, RIGHT) - tip_deflection(&s, LEFT);
    if (last < 0 && now >= 0) {
      last_time = (k + last / (last - now)) * o->dt;
      first_time = first_time < 0 ? last_time : first_time;
      crossings++;
    }
    last = now;
  }
  return crossings > 1 ? 2 * pi * (crossings - 1) / (last_time - first_time) : 0;
}

/* ---- results */

/* Largest pointing error [rad], and largest deviation of a tip from the middle of its range [m], in the last 10 s. */
static void residuals(const history *h, double *error, double *swing)
{
  double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
  *error = 0;
  for (int k = 0; k < h->rows; k++) {
    for (int i = 0; i < 2 && h->t[k] >= h->t[h->rows - 1] - 10; i++) {
      *error = fmax(*error, h->error[k]);
      low[i] = fmin(low[i], h->tip[i][k]);
      high[i] = fmax(high[i], h->tip[i][k]);
    }
  }
  *swing = 0.5 * fmax(high[0] - low[0], high[1] - low[1]);
}

static int write_csv(const history h[2], const char *path)
{
  FILE *file = fopen(path, "w");
  int ok = file != NULL;
  if (file) {
    ok = fprintf(file, "t,error_deg,tip_right,tip_left,torque,notch_error_deg,notch_tip_right,notch_tip_left,"
                       "notch_torque\n") > 0;
    for (int k = 0; k < h[0].rows && ok; k++) {
      ok = fprintf(file, "%.10g", h[0].t[k]) > 0;
      for (int i = 0; i < 2 && ok; i++) {
        ok = fprintf(file, ",%.8g,%.8g,%.8g,%.8g", h[i].error[k] / degree, h[i].tip[0][k], h[i].tip[1][k],
                     h[i].torque[k]) > 0;
      }
      ok = ok && fputc('\n', file) != EOF;
    }
    ok = fclose(file) == 0 && ok;
  }
  return ok ? 0 : fail("cannot write", path);
}

static void draw(const char *csv)
{
  char svg[512];
  const curve errors[] = {{csv, "1:2", "every ::1 with lines lw 1.5 lc rgb '#dd181f'", "without notch"},
                          {csv, "1:6", "every ::1 with lines lw 2 lc rgb '#0060ad'", "with notch"}};
  const curve tips[] = {{csv, "1:3", "every ::1 with lines lw 1.5 lc rgb '#dd181f'", "without notch"},
                        {csv, "1:7", "every ::1 with lines lw 2 lc rgb '#0060ad'", "with notch"}};
  other_name(svg, sizeof svg, csv, "_error.svg");
  plot(svg,
       "set key top left\nset logscale y\nset format y '10^{%L}'\nset ylabel 'pointing error [deg]'\n"
       "set title 'Slew of a spacecraft with flexible arrays: distance from the commanded attitude'\n",
       errors, 2, stdout);
  other_name(svg, sizeof svg, csv, "_tip.svg");
  plot(svg,
       "set key top left\nset ylabel 'deflection of the tip of the right array [m]'\n"
       "set title 'Slew of a spacecraft with flexible arrays: out-of-plane bending'\n",
       tips, 2, stdout);
}

static int misses;

static void check(const char *what, double got, double bound)
{
  printf("  %-58s %10.3g  below %8.3g  %s\n", what, got, bound, got < bound ? "ok" : "FAILED");
  misses += !(got < bound);
}

int main(int argc, char **argv)
{
  static history h[2];
  options o = {30, 40, 120, 0.4, 0.4, 1, 10, 0.005, 0.06, 30, 0.25, 0.002, DRIVE_RATE, "spacecraft.csv"};
  double swing, measured, error[2], residual[2], coarse;
  int bad;
  output_begin(PROGRAM);
  bad = read_options(&o, argc, argv);
  if (bad) {
    return bad;
  }
  make_craft(&o);
  swing = swing_frequency(&o);
  coarse = fmax(1, pow(o.dt / 0.002, 2)); /* the error of the trapezoidal rule */
  measured = measured_swing(&o);
  printf("array clamped %.4f Hz; hub and arrays swing at %.4f Hz by the closed form, at %.4f Hz in the model\n",
         o.frequency, swing / (2 * pi), measured / (2 * pi));
  for (int k = 0; k < 2; k++) {
    run(&h[k], &o, k);
    residuals(&h[k], &error[k], &residual[k]);
    printf(
        "%-8s notch: last 10 s: error up to %.3g deg, tips swing by %.3g m; work of the torque %.4g J, lost %.4g J\n",
        k ? "with" : "without", error[k] / degree, residual[k], h[k].work, h[k].lost);
  }
  if (write_csv(h, o.out)) {
    return 2;
  }
  printf("curves: %s\n", o.out);
  draw(o.out);
  check("swing frequency, closed form against model", fabs(measured / swing - 1), 5e-3);
  for (int k = 0; k < 2; k++) {
    check("angular momentum less impulse, part of all impulses", h[k].momentum_miss,
          (FB_SINGLE ? 1e-4 : 1e-7) * coarse);
    check("energy less work and loss, part of all work", h[k].energy_miss, (FB_SINGLE ? 1e-3 : 1e-5) * coarse);
  }
  check("with notch: error in the last 10 s [deg]", error[1] / degree, 0.01);
  check("with notch: swing of the tips, part of that without", residual[1] / residual[0], 0.1);
  return misses != 0;
}
