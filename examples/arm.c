/* arm - a robot arm with two flexible links, moved from point to point by its joint controllers.
   The arm hangs in a vertical plane: a shoulder and an elbow with motors, both links bending, a payload at the tip.
   Every millisecond the controller reads the joint encoders and, if asked to, strain gauges at the roots of the links.
   It knows the arm as if it were rigid:

     tau = M(th_d) th_d'' + h(th_d, th_d') + G(th_d) + friction + Kp (th_d + r - th) + Kd (th_d' + r' - th')

   With r = 0 the joints are stiff, and the arm rings on them long after the move. With strain damping each joint gives
   way, r' = g (EI kappa) in the band of the vibration, so that its motor takes the energy out of the link. The links
   have no damping of their own: what dies out is the controller's doing.
   Exit: 0 well, 1 a check failed or the motion left the model, 2 bad options. */
#define _POSIX_C_SOURCE 200809L /* popen, for gnuplot */
#define FB_MAX_BODIES 2
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#define PROGRAM "arm"
#include "common/options.h"
#include "common/output.h"
#include "common/plot.h"

enum { LINKS = 2, GAUGE = 1, TIP = 2 }; /* nodes of a link: end of the strain gauge, tip */
static const double pi = 3.14159265358979324, gravity = 9.81;
static const double period = 1e-3;       /* [s] of the controller */
static const double gauge_length = 0.05; /* [m] */

typedef struct link_data {
  double length, mass, EI; /* [m], [kg/m], [N m^2] */
  double tip_mass;         /* [kg] elbow motor, payload */
  double tip_inertia;      /* [kg m^2] of the elbow with its stator, of the payload */
  double rotor;            /* [kg m^2] motor and gear that turn with the link */
  double friction;         /* [N m s] of the joint */
  double Kp, Kd;           /* [N m/rad], [N m s/rad] */
  double from, to;         /* [rad] the elbow's angle is relative to the first link */
  double gain;             /* [1/(N m s)] of the strain damping */
} link_data;

static link_data arm[LINKS] = {{1.0, 1.5, 2000, 1.5, 0.3, 1.0, 2.0, 12000, 300, -1.2, 0.5, 0.004},
                               {1.0, 1.0, 1000, 2.0, 0.01, 0.3, 0.5, 3000, 40, 1.6, -0.3, 0.01}};

typedef struct options {
  double payload, move, end, gain; /* [kg], [s], [s], factor of the strain damping */
  const char *out;
} options;

static const char help[] =
    "arm - a robot arm with two flexible links moves from point to point, without and with strain damping\n"
    "usage: arm [options]\n"
    "  --payload M  [kg] at the tip, 0 to 3 (2)\n"
    "  --move T     [s] duration of the move, at least 0.5 (1)\n"
    "  --t-end T    [s] end of the run, at least 3 s after the move (5)\n"
    "  --gain G     factor of the strain damping, 0.25 to 1 (1)\n"
    "  --out FILE   CSV of the run with strain damping (arm.csv); beside it _stiff.csv of the other and the picture\n"
    "  --help       this text\n"
    "CSV: t [s], demanded, encoder angles [rad], torques [N m], tip x, y [m], tip off the rigid arm at those angles "
    "[m],\n"
    "energy, work of the motors, friction loss [J].\n";

static int read_option(void *target, const char *name, const char *text)
{
  options *const o = target;
  const number_option numbers[] = {{"--payload", &o->payload, 0, 3},
                                   {"--move", &o->move, 0.5, 100},
                                   {"--t-end", &o->end, 3.5, 1000},
                                   {"--gain", &o->gain, 0.25, 1}};
  return strcmp(name, "--out") == 0 ? read_out(&o->out, text) : read_number(numbers, 4, name, text);
}

static int read_options(options *o, int argc, char **argv)
{
  const int status = read_all(argc, argv, help, read_option, o);
  if (status != 0) {
    return status;
  }
  return o->end >= o->move + 3 ? 0 : fail("--t-end must be at least 3 s after the move", "");
}

/* ---- model: link i hangs by a revolute joint about z; bending in the plane, displacement along y */

static fb_body model[LINKS];
static fb_system mechanism;
static fb_system_work work;

/* Component modes: whatever loads the tip bends the link exactly, so that the sag is right with three coordinates. */
static fb_status build_link(fb_body *body, const link_data *d)
{
  static fb_beam_desc desc;
  static fb_beam beam;
  static fb_modes_desc keep;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_shape shape;
  static fb_body_desc level;
  static fb_body_work body_work;
  const fb_real center[3] = {0}, inertia[6] = {(fb_real)d->rotor, (fb_real)d->rotor, (fb_real)d->rotor, 0, 0, 0};
  int node;
  fb_status status;
  desc.length = (fb_real)d->length;
  desc.n_element = 8;
  desc.n_station = 1;
  desc.station[0].mass = (fb_real)d->mass;
  desc.station[0].EI_z = (fb_real)d->EI;
  desc.n_lump = 1;
  desc.lump[0].node = desc.n_element;
  desc.lump[0].mass = (fb_real)d->tip_mass;
  desc.lump[0].inertia[0] = desc.lump[0].inertia[1] = desc.lump[0].inertia[2] = (fb_real)d->tip_inertia;
  keep.basis = FB_BASIS_COMPONENT;
  keep.count[FB_KIND_BEND_Y] = 1;
  keep.n_boundary = 2;
  keep.boundary[0].node = keep.boundary[1].node = desc.n_element;
  keep.boundary[0].axis = 1; /* u_y */
  keep.boundary[1].axis = 5; /* theta_z */
  level.effects = FB_EFFECTS_FULL | FB_EFFECT_GRAVITY;
  level.base = FB_BASE_PRESCRIBED;
  level.gravity[1] = -(fb_real)gravity;
  status = fb_beam_init(&beam, &desc);
  status = status ? status : fb_modes_solve(&modes, &modes_work, &beam, &keep);
  status = status ? status : fb_shape_init(&shape, modes.n);
  status = status ? status : fb_shape_add_rigid(&shape, 0, center, inertia);
  status = status ? status : fb_shape_add_beam(&shape, 0, &beam, &modes);
  status = status ? status : fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, (fb_real)gauge_length);
  status = status ? status : fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, desc.length);
  return status ? status : fb_body_init(body, &body_work, &shape, &level);
}

static fb_status build(void)
{
  static fb_system_desc desc;
  fb_status status = FB_OK;
  desc.n_body = LINKS;
  for (int i = 0; i < LINKS && status == FB_OK; i++) {
    fb_joint_desc *joint = &desc.joint[i];
    status = build_link(&model[i], &arm[i]);
    desc.model[i] = i;
    joint->kind = FB_JOINT_REVOLUTE;
    joint->parent = i - 1; /* the shoulder: FB_GROUND */
    joint->parent_node = i == 0 ? 0 : TIP;
    joint->damping[0] = (fb_real)arm[i].friction;
  }
  return status ? status : fb_system_init(&mechanism, &work, model, &desc, LINKS);
}

/* ---- what the controller knows: the rigid arm and the profile */

typedef struct demand {
  double angle[LINKS], rate[LINKS], acceleration[LINKS];
} demand;

/* From `from` to `to` by the polynomial of degree 5 that starts and ends at rest without a jump in acceleration. */
static void profile(demand *d, double t, double move)
{
  const double s = t < move ? t / move : 1;
  const double x = s * s * s * (10 - 15 * s + 6 * s * s);
  const double v = 30 * s * s * (1 - s) * (1 - s) / move;
  const double a = 60 * s * (1 - s) * (1 - 2 * s) / (move * move);
  for (int i = 0; i < LINKS; i++) {
    const double way = arm[i].to - arm[i].from;
    d->angle[i] = arm[i].from + way * x;
    d->rate[i] = way * v;
    d->acceleration[i] = way * a;
  }
}

/* Torques that move the rigid arm as demanded, M th'' + h + G + friction: the textbook's two-link arm. */
static void rigid_torques(double tau[LINKS], const demand *d)
{
  const double l = arm[0].length, l2 = arm[1].length;
  const double m2 = arm[1].mass * l2 + arm[1].tip_mass;            /* [kg] */
  const double c2 = l2 * (arm[1].mass * l2 / 2 + arm[1].tip_mass); /* [kg m] about the elbow */
  const double J2 =
      l2 * l2 * (arm[1].mass * l2 / 3 + arm[1].tip_mass) + arm[1].rotor + arm[1].tip_inertia; /* [kg m^2] */
  const double c1 = l * (arm[0].mass * l / 2 + arm[0].tip_mass + m2);
  const double J1 = l * l * (arm[0].mass * l / 3 + arm[0].tip_mass + m2) + arm[0].rotor + arm[0].tip_inertia;
  const double c = cos(d->angle[1]), s = sin(d->angle[1]);
  const double w = d->rate[0], u = d->rate[1], a = d->acceleration[0], b = d->acceleration[1];
  const double G2 = gravity * c2 * cos(d->angle[0] + d->angle[1]);
  tau[0] = (J1 + J2 + 2 * l * c2 * c) * a + (J2 + l * c2 * c) * b - l * c2 * s * u * (2 * w + u) +
           gravity * c1 * cos(d->angle[0]) + G2;
  tau[1] = (J2 + l * c2 * c) * a + J2 * b + l * c2 * s * w * w + G2;
  for (int i = 0; i < LINKS; i++) {
    tau[i] += arm[i].friction * d->rate[i];
  }
}

static void rigid_tip(double tip[2], const double angle[LINKS])
{
  const double sum = angle[0] + angle[1];
  tip[0] = arm[0].length * cos(angle[0]) + arm[1].length * cos(sum);
  tip[1] = arm[0].length * sin(angle[0]) + arm[1].length * sin(sum);
}

/* Where the tip hangs at rest: each link a cantilever under its own weight q, the force F and moment T at its tip,
     u = (F/3 + M/(2 L) + q L/8) L^3/EI,  phi = (F/2 + M/L + q L/6) L^2/EI;  across the bent link, which turns the
     next. */
static void sagging_tip(double tip[2], const double angle[LINKS])
{
  double direction = 0;
  tip[0] = tip[1] = 0;
  for (int i = 0; i < LINKS; i++) {
    const link_data *d = &arm[i];
    const double beyond = i == 0 ? arm[1].mass * arm[1].length + arm[1].tip_mass : 0;
    const double lever = arm[1].length * (arm[1].mass * arm[1].length / 2 + arm[1].tip_mass);
    const double at = direction + angle[i], g = -gravity * cos(at), L = d->length;
    const double F = g * (d->tip_mass + beyond), q = g * d->mass;
    const double T = i == 0 ? -gravity * lever * cos(at + angle[1]) : 0;
    const double u = (F / 3 + T / (2 * L) + q * L / 8) * L * L * L / d->EI;
    const double phi = (F / 2 + T / L + q * L / 6) * L * L / d->EI;
    tip[0] += L * cos(at) - u * sin(at);
    tip[1] += L * sin(at) + u * cos(at);
    direction = at + phi;
  }
}

/* ---- the controller, in double precision whatever the plant has */

typedef struct controller {
  double last[LINKS];           /* [rad] encoder angles a period ago */
  double slow[LINKS], r[LINKS]; /* filtered moments [N m]; how far the joints give way [rad] */
} controller;

/* Encoders of 20 bits. */
static double encoder(double angle)
{
  const double count = 2 * pi / 1048576;
  return count * floor(angle / count + 0.5);
}

/* r' = g (M - slow M) - w r: the moment's band around w and above, integrated; at rest r is zero and the demand
   holds. */
static double give_way(controller *c, int i, double moment, double gain)
{
  const double w = 2 * pi * 0.5; /* [rad/s] well below the vibration */
  const double rate = gain * arm[i].gain * (moment - c->slow[i]) - w * c->r[i];
  c->slow[i] += period * w * (moment - c->slow[i]);
  c->r[i] += period * rate;
  return rate;
}

static void control(double tau[LINKS], controller *c, const demand *d, const double angle[LINKS],
                    const double moment[LINKS], double gain)
{
  rigid_torques(tau, d);
  for (int i = 0; i < LINKS; i++) {
    const double give = give_way(c, i, moment[i], gain);
    const double speed = (angle[i] - c->last[i]) / period;
    tau[i] += arm[i].Kp * (d->angle[i] + c->r[i] - angle[i]) + arm[i].Kd * (d->rate[i] + give - speed);
    c->last[i] = angle[i];
  }
}

/* ---- one run: at first the arm settles at its start, at rest but for the sag; then it moves */

static const double settling = 4; /* [s] before t = 0 */

typedef struct sensors {
  double angle[LINKS], moment[LINKS]; /* [rad] encoders, [N m] by the gauges at the roots */
  double speed[LINKS];                /* [rad/s] */
  double tip[2], off;                 /* [m] of the payload; across the last link, off the rigid arm at those angles */
} sensors;

typedef struct result {
  double tracking, last_tracking; /* [rad] largest error of the encoders while moving, and in the last 0.5 s */
  double lowest, highest;         /* [m] of the tip off the rigid arm from 1 s to 2 s after the move */
  double miss, sag;               /* [m] at the end: from where the tip should hang; that from the rigid arm's tip */
  double balance, work;           /* [J] largest |energy - work + loss|, most work done */
} result;

typedef struct plant {
  fb_system_state state;
  fb_system_input input;
  double energy, first, loss; /* [J]: now, at the start, by friction */
} plant;

static fb_status sense(sensors *s, const plant *p)
{
  static fb_system_motion motion;
  fb_node_motion node;
  double rigid[2] = {0, 0}, sum;
  fb_status status = fb_system_motion_eval(&mechanism, model, &work, &motion, &p->state, &p->input);
  for (int i = 0; i < LINKS && status == FB_OK; i++) {
    s->angle[i] = encoder((double)p->state.link[i].x[0]);
    s->speed[i] = (double)motion.joint[i].speed[0];
    status = fb_body_node_motion_eval(&model[i], &node, &motion.pose[i], &motion.motion[i], GAUGE);
    s->moment[i] = arm[i].EI * (double)node.rotation[2] / gauge_length;
    status = status ? status : fb_body_node_motion_eval(&model[i], &node, &motion.pose[i], &motion.motion[i], TIP);
  }
  if (status == FB_OK) {
    rigid_tip(rigid, s->angle);
    sum = s->angle[0] + s->angle[1];
    s->tip[0] = (double)node.position[0];
    s->tip[1] = (double)node.position[1];
    s->off = (s->tip[1] - rigid[1]) * cos(sum) - (s->tip[0] - rigid[0]) * sin(sum);
  }
  return status;
}

/* A period with held torques; friction takes c u^2, summed by trapezoids. */
static fb_status advance(plant *p, sensors *s, int steps)
{
  const double dt = period / steps;
  fb_energy e = {0, 0, 0};
  fb_status status = FB_OK;
  for (int k = 0; k < steps && status == FB_OK; k++) {
    const double before[LINKS] = {s->speed[0], s->speed[1]};
    status = fb_system_rk4_step(&mechanism, model, &p->state, &work, &p->input, &p->input, &p->input, (fb_real)dt);
    status = status ? status : sense(s, p);
    for (int i = 0; i < LINKS; i++) {
      p->loss += dt * arm[i].friction * (before[i] * before[i] + s->speed[i] * s->speed[i]) / 2;
    }
  }
  status = status ? status : fb_system_energy_eval(&mechanism, model, &work, &e, &p->state, &p->input);
  p->energy = (double)(e.kinetic + e.strain + e.gravity);
  return status;
}

/* Steps per period that stay well below the limit of rk4. */
static int steps_per_period(void)
{
  const double omega = sqrt((double)mechanism.limit_elastic); /* [rad/s] bound of the highest frequency */
  return (int)ceil(period * omega);
}

static double distance(const double a[2], const double b[2])
{
  return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]));
}

static void judge(result *r, const options *o, double t, const sensors *s, const demand *d, const plant *p)
{
  const double motors = (double)p->state.motor_work;
  double hang[2], straight[2], aim[LINKS];
  for (int i = 0; i < LINKS; i++) {
    const double error = fabs(s->angle[i] - d->angle[i]);
    r->tracking = t >= 0 ? fmax(r->tracking, error) : 0;
    r->last_tracking = t > o->end - 0.5 ? fmax(r->last_tracking, error) : 0;
    aim[i] = arm[i].to;
  }
  if (t >= o->move + 1 && t <= o->move + 2) {
    r->lowest = fmin(r->lowest, s->off);
    r->highest = fmax(r->highest, s->off);
  }
  sagging_tip(hang, aim);
  rigid_tip(straight, aim);
  r->miss = distance(s->tip, hang);
  r->sag = distance(hang, straight);
  r->balance = fmax(r->balance, fabs(p->energy - p->first - motors + p->loss));
  r->work = fmax(r->work, fabs(motors));
}

static void write_row(FILE *file, double t, const sensors *s, const demand *d, const plant *p)
{
  fprintf(file, "%.6f,%.9g,%.9g,%.9g,%.9g,%.6g,%.6g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", t, d->angle[0], d->angle[1],
          s->angle[0], s->angle[1], (double)p->input.drive[0].torque[0], (double)p->input.drive[1].torque[0], s->tip[0],
          s->tip[1], s->off, p->energy, (double)p->state.motor_work, p->loss);
}

static fb_status start(plant *p, sensors *s)
{
  static fb_link_motion motion[LINKS];
  fb_energy e = {0, 0, 0};
  fb_status status;
  memset(p, 0, sizeof *p);
  memset(s, 0, sizeof *s);
  for (int i = 0; i < LINKS; i++) {
    motion[i].value[0] = (fb_real)arm[i].from;
  }
  status = fb_system_state_init(&mechanism, model, &p->state, &work, motion, &p->input);
  status = status ? status : sense(s, p);
  status = status ? status : fb_system_energy_eval(&mechanism, model, &work, &e, &p->state, &p->input);
  p->first = p->energy = (double)(e.kinetic + e.strain + e.gravity);
  return status;
}

static fb_status run(result *r, const options *o, int damped, FILE *file)
{
  static plant p;
  const int periods = (int)floor((settling + o->end) / period + 0.5), steps = steps_per_period();
  controller c;
  sensors s;
  demand d;
  fb_status status = start(&p, &s);
  memset(&c, 0, sizeof c);
  memset(r, 0, sizeof *r);
  memcpy(c.last, s.angle, sizeof c.last);
  r->lowest = 1e9;
  r->highest = -1e9;
  fprintf(file, "t,th1_demand,th2_demand,th1,th2,tau1,tau2,tip_x,tip_y,tip_off,energy,work,loss\n");
  for (int k = 0; k <= periods && status == FB_OK; k++) {
    const double t = period * k - settling;
    double tau[LINKS];
    profile(&d, fmax(t, 0), o->move);
    control(tau, &c, &d, s.angle, s.moment, t < 0 ? 1 : damped ? o->gain : 0);
    for (int i = 0; i < LINKS; i++) {
      p.input.drive[i].torque[0] = (fb_real)tau[i];
    }
    judge(r, o, t, &s, &d, &p);
    if (t >= 0 && k % 5 == 0) {
      write_row(file, t, &s, &d, &p);
    }
    status = advance(&p, &s, steps);
  }
  return status;
}

/* ---- both runs */

static int run_to_file(result *r, const options *o, int damped, const char *name)
{
  FILE *file = fopen(name, "w");
  fb_status status;
  if (!file) {
    return fail("cannot write", name);
  }
  status = run(r, o, damped, file);
  if (output_close(file, name)) {
    return 2;
  }
  if (status != FB_OK) {
    fprintf(stderr, "arm: %s\n", fb_status_string(status));
    return 1;
  }
  printf("%-15s %9.4f mm %11.4f mrad %11.5f mrad %9.4f mm %9.2e J\n", damped ? "strain damping" : "stiff joints",
         1e3 * (r->highest - r->lowest), 1e3 * r->tracking, 1e3 * r->last_tracking, 1e3 * r->miss, r->balance);
  return 0;
}

static int check(const char *what, double value, double bound)
{
  const int ok = value <= bound;
  printf("check: %s: %.3g, at most %.3g: %s\n", what, value, bound, ok ? "ok" : "FAILED");
  return ok;
}

static int check_all(const result r[2])
{
  int ok = 1;
  for (int k = 0; k < 2; k++) {
    ok &= check("energy - work of the motors + friction loss, of the work", r[k].balance / r[k].work,
                FB_SINGLE ? 1e-3 : 1e-5);
  }
  ok &= check("encoders while moving, stiff joints [rad]", r[0].tracking, 0.1);
  ok &= check("encoders at the end, strain damping [rad]", r[1].last_tracking, 1e-3);
  ok &= check("tip at the end off the rigid arm's with static sag, of the sag", r[1].miss / r[1].sag, 0.05);
  if (r[0].highest - r[0].lowest > 0.01) { /* a slow move hardly rings */
    ok &= check("ringing with strain damping, of that of stiff joints",
                (r[1].highest - r[1].lowest) / (r[0].highest - r[0].lowest), 0.25);
  }
  return ok;
}

int main(int argc, char **argv)
{
  options o = {2, 1, 5, 1, "arm.csv"};
  static char stiff[512], svg[512];
  result r[2];
  int status;
  fb_status built;
  output_begin(PROGRAM);
  status = read_options(&o, argc, argv);
  if (status != 0) {
    return status;
  }
  arm[1].tip_mass = o.payload;
  built = build();
  if (built != FB_OK) {
    fprintf(stderr, "arm: %s\n", fb_status_string(built));
    return 1;
  }
  other_name(stiff, sizeof stiff, o.out, "_stiff.csv");
  other_name(svg, sizeof svg, o.out, ".svg");
  printf("arm with two flexible links, %d and %d coordinates; controller at 1 kHz, %d steps of rk4 a period\n",
         model[0].n, model[1].n, steps_per_period());
  printf("                  ringing   tracking, moving    tracking, end      miss    balance\n");
  status = run_to_file(&r[0], &o, 0, stiff);
  status = status ? status : run_to_file(&r[1], &o, 1, o.out);
  if (status != 0) {
    return status;
  }
  {
    const curve curves[] = {{stiff, "1:(1000*$10)", "every ::1 with lines lw 2 lc rgb '#dd181f'", "stiff joints"},
                            {o.out, "1:(1000*$10)", "every ::1 with lines lw 2 lc rgb '#0060ad'", "strain damping"}};
    plot(svg, "set ylabel 'tip off the rigid arm [mm]'\nset title 'A flexible arm moves from point to point'\n", curves,
         2, stdout);
  }
  status = check_all(r) ? 0 : 1;
  return status;
}
