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
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#define PROGRAM "arm"
#include "common/check.h"
#include "common/balance.h"
#include "common/options.h"
#include "common/output.h"
#include "common/plot.h"
#include "common/rigid_arm.h"

enum { GAUGE = 1, TIP = 2 }; /* nodes of a link: end of the strain gauge, tip */
static const double pi = 3.14159265358979324;
static const double period = 1e-3, settling = 4, rest = 4; /* [s] of the controller, before and after the move */
static const double gauge_length = 0.05;                   /* [m] */

static link_data arm[LINKS] = {{1.0, 1.5, 2000, 1.5, 0.3, 1.0, 2.0, 12000, 300, -1.2, 0.5, 0.004},
                               {1.0, 1.0, 1000, 2.0, 0.01, 0.3, 0.5, 3000, 40, 1.6, -0.3, 0.01}};

typedef struct options {
  double payload, move; /* [kg], [s] */
  const char *out;
} options;

static const char help[] =
    "arm - a robot arm with two flexible links moves from point to point, without and with strain damping\n"
    "usage: arm [options]\n"
    "  --payload M  [kg] at the tip, 0 to 3 (2)\n"
    "  --move T     [s] duration of the move, at least 0.5 (1)\n"
    "  --out FILE   CSV of the run with strain damping (arm.csv); beside it _stiff.csv of the other and the picture\n"
    "  --help       this text\n"
    "CSV: t [s], demanded, encoder angles [rad], torques [N m], tip x, y [m], tip off the rigid arm at those angles\n"
    "[m], energy, work of the motors, friction loss [J].\n";

static int read_option(void *target, const char *name, const char *text)
{
  options *const o = target;
  const number_option numbers[] = {{"--payload", &o->payload, 0, 3}, {"--move", &o->move, 0.5, 100}};
  return strcmp(name, "--out") == 0 ? read_out(&o->out, text) : read_number(numbers, 2, name, text);
}

/* ---- model: link i hangs by a revolute joint about z; bending in the plane, displacement along y */

static fb_body model[LINKS];
static fb_system mechanism;
static fb_system_work work;

/* Component modes: whatever loads the tip bends the link exactly, so that the sag is right with three coordinates. */
static fb_status build_link(fb_body *body, const link_data *d)
{
  static fb_build_work scratch;
  const fb_real J = (fb_real)d->rotor, L = (fb_real)d->length, Jt = (fb_real)d->tip_inertia;
  const fb_beam_desc beam = {.length = L,
                             .n_element = 8,
                             .n_station = 1,
                             .station = {{.mass = (fb_real)d->mass, .EI_z = (fb_real)d->EI}},
                             .n_lump = 1,
                             .lump = {{.node = 8, .mass = (fb_real)d->tip_mass, .inertia = {Jt, Jt, Jt}}}};
  const fb_modes_desc keep = {.basis = FB_BASIS_COMPONENT,
                              .count = {1},
                              .n_boundary = 2,
                              .boundary = {{.node = 8, .axis = 1}, {.node = 8, .axis = 5}}}; /* u_y, theta_z */
  const fb_build_desc desc = {.inertia = {J, J, J},
                              .n_part = 1,
                              .part = {{.n_node = 2, .node = {(fb_real)gauge_length, L}}},
                              .body = {.effects = FB_EFFECTS_FULL | FB_EFFECT_GRAVITY,
                                       .base = FB_BASE_PRESCRIBED,
                                       .gravity = {0, -(fb_real)gravity}}};
  return fb_body_build(body, &scratch, &desc, &beam, &keep, 1);
}

static void build(void)
{
  fb_system_desc desc = {.n_body = LINKS};
  for (int i = 0; i < LINKS; i++) {
    need(build_link(&model[i], &arm[i]), "link");
    desc.model[i] = i;
    desc.joint[i].kind = FB_JOINT_REVOLUTE;
    desc.joint[i].parent = i - 1; /* the shoulder: FB_GROUND */
    desc.joint[i].parent_node = i == 0 ? 0 : TIP;
    desc.joint[i].damping[0] = (fb_real)arm[i].friction;
  }
  need(fb_system_init(&mechanism, &work, model, &desc, LINKS), "arm");
}

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

/* ---- the plant, and the controller in double precision whatever the plant has */

typedef struct plant {
  fb_system_state state;
  fb_system_input input;
  double angle[LINKS], moment[LINKS]; /* [rad] encoders, [N m] by the gauges at the roots */
  double speed[LINKS];                /* [rad/s] */
  double tip[2], off;                 /* [m] of the payload; across the last link, off the rigid arm at those angles */
  double last[LINKS];                 /* [rad] encoder angles a period ago */
  double slow[LINKS], r[LINKS];       /* filtered moments [N m]; how far the joints give way [rad] */
  balance balance;
  double loss; /* [J] by friction */
} plant;

/* Encoders of 20 bits. */
static double encoder(double angle)
{
  const double count = 2 * pi / 1048576;
  return count * floor(angle / count + 0.5);
}

static void sense(plant *p)
{
  static fb_system_motion motion;
  fb_node_motion node;
  double rigid[2], sum;
  need(fb_system_motion_eval(&mechanism, model, &work, &motion, &p->state, &p->input), "motion");
  for (int i = 0; i < LINKS; i++) {
    p->angle[i] = encoder((double)p->state.link[i].x[0]);
    p->speed[i] = (double)motion.joint[i].speed[0];
    need(fb_body_node_motion_eval(&model[i], &node, &motion.pose[i], &motion.motion[i], GAUGE), "gauge");
    p->moment[i] = arm[i].EI * (double)node.rotation[2] / gauge_length;
    need(fb_body_node_motion_eval(&model[i], &node, &motion.pose[i], &motion.motion[i], TIP), "tip");
  }
  rigid_tip(rigid, arm, p->angle);
  sum = p->angle[0] + p->angle[1];
  p->tip[0] = (double)node.position[0];
  p->tip[1] = (double)node.position[1];
  p->off = (p->tip[1] - rigid[1]) * cos(sum) - (p->tip[0] - rigid[0]) * sin(sum);
}

/* Torques. The joints give way by r' = g (M - slow M) - w r: the moment's band around w and above, integrated; at rest
   r is zero and the demand holds. */
static void control(plant *p, const demand *d, int damped)
{
  const double w = 2 * pi * 0.5; /* [rad/s] well below the vibration */
  double tau[LINKS];
  rigid_torques(tau, arm, d);
  for (int i = 0; i < LINKS; i++) {
    const double give = damped * arm[i].gain * (p->moment[i] - p->slow[i]) - w * p->r[i];
    const double speed = (p->angle[i] - p->last[i]) / period;
    p->slow[i] += period * w * (p->moment[i] - p->slow[i]);
    p->r[i] += period * give;
    tau[i] += arm[i].Kp * (d->angle[i] + p->r[i] - p->angle[i]) + arm[i].Kd * (d->rate[i] + give - speed);
    p->last[i] = p->angle[i];
    p->input.drive[i].torque[0] = (fb_real)tau[i];
  }
}

/* Steps per period that stay well below the limit of rk4. */
static int steps_per_period(void)
{
  return (int)ceil(period * sqrt((double)mechanism.limit_elastic)); /* [rad/s] bound of the highest frequency */
}

/* A period with held torques; friction takes c u^2, summed by trapezoids. */
static void advance(plant *p)
{
  const int steps = steps_per_period();
  const double dt = period / steps;
  for (int k = 0; k < steps; k++) {
    const double before[LINKS] = {p->speed[0], p->speed[1]};
    need(fb_system_rk4_step(&mechanism, model, &p->state, &work, &p->input, &p->input, &p->input, (fb_real)dt), "step");
    sense(p);
    for (int i = 0; i < LINKS; i++) {
      p->loss += dt * arm[i].friction * (before[i] * before[i] + p->speed[i] * p->speed[i]) / 2;
    }
  }
  p->balance.work = (double)p->state.motor_work - p->loss;
  balance_look(&p->balance, &mechanism, model, &work, &p->state, &p->input);
}

/* ---- one run: at first the arm settles at its start, at rest but for the sag; then it moves */

typedef struct result {
  double tracking, last_tracking; /* [rad] largest error of the encoders while moving, and in the last 0.5 s */
  double lowest, highest;         /* [m] of the tip off the rigid arm from 1 s to 2 s after the move */
  double miss, sag;               /* [m] at the end: from where the tip should hang; that from the rigid arm's tip */
  double balance, work;           /* [J] largest |energy - work + loss|, most work done */
} result;

static void judge(result *r, double t, double move, const plant *p, const demand *d)
{
  const double aim[LINKS] = {arm[0].to, arm[1].to};
  double hang[2], straight[2];
  for (int i = 0; i < LINKS; i++) {
    const double error = fabs(p->angle[i] - d->angle[i]);
    r->tracking = t >= 0 ? fmax(r->tracking, error) : 0;
    r->last_tracking = t > move + rest - 0.5 ? fmax(r->last_tracking, error) : 0;
  }
  if (t >= move + 1 && t <= move + 2) {
    r->lowest = fmin(r->lowest, p->off);
    r->highest = fmax(r->highest, p->off);
  }
  sagging_tip(hang, arm, aim);
  rigid_tip(straight, arm, aim);
  r->miss = hypot(p->tip[0] - hang[0], p->tip[1] - hang[1]);
  r->sag = hypot(hang[0] - straight[0], hang[1] - straight[1]);
  r->work = fmax(r->work, fabs((double)p->state.motor_work));
}

static void run(result *r, double move, int damped, FILE *file)
{
  static plant p;
  const int periods = (int)floor((settling + move + rest) / period + 0.5);
  const fb_link_motion start[LINKS] = {{.value = {(fb_real)arm[0].from}}, {.value = {(fb_real)arm[1].from}}};
  demand d;
  memset(&p, 0, sizeof p);
  need(fb_system_state_init(&mechanism, model, &p.state, &work, start, &p.input), "initial state");
  sense(&p);
  memcpy(p.last, p.angle, sizeof p.last);
  balance_begin(&p.balance, &mechanism, model, &work, &p.state, &p.input);
  fprintf(file, "t,th1_demand,th2_demand,th1,th2,tau1,tau2,tip_x,tip_y,tip_off,energy,work,loss\n");
  for (int k = 0; k <= periods; k++) {
    const double t = period * k - settling;
    profile(&d, fmax(t, 0), move);
    control(&p, &d, t < 0 || damped);
    judge(r, t, move, &p, &d);
    if (t >= 0 && k % 5 == 0) {
      fprintf(file, "%.6f,%.9g,%.9g,%.9g,%.9g,%.6g,%.6g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", t, d.angle[0], d.angle[1],
              p.angle[0], p.angle[1], (double)p.input.drive[0].torque[0], (double)p.input.drive[1].torque[0], p.tip[0],
              p.tip[1], p.off, p.balance.energy_now, (double)p.state.motor_work, p.loss);
    }
    r->balance = p.balance.energy_miss;
    advance(&p);
  }
}

int main(int argc, char **argv)
{
  options o = {2, 1, "arm.csv"};
  char stiff[512], svg[512];
  result r[2] = {{.lowest = 1e9, .highest = -1e9}, {.lowest = 1e9, .highest = -1e9}};
  output_begin(PROGRAM);
  if (read_all(argc, argv, help, read_option, &o) != 0) {
    return 2;
  }
  arm[1].tip_mass = o.payload;
  build();
  other_name(stiff, sizeof stiff, o.out, "_stiff.csv");
  other_name(svg, sizeof svg, o.out, ".svg");
  printf("arm with two flexible links, %d and %d coordinates; controller at 1 kHz, %d steps of rk4 a period\n",
         model[0].n, model[1].n, steps_per_period());
  printf("                  ringing   tracking, moving    tracking, end      miss    balance\n");
  for (int damped = 0; damped < 2; damped++) {
    const char *const name = damped ? o.out : stiff;
    result *const at = &r[damped];
    FILE *file = output_open(name);
    if (!file) {
      return fail("cannot write", name);
    }
    run(at, o.move, damped, file);
    if (output_close(file, name)) {
      return 2;
    }
    printf("%-15s %9.4f mm %11.4f mrad %11.5f mrad %9.4f mm %9.2e J\n", damped ? "strain damping" : "stiff joints",
           1e3 * (at->highest - at->lowest), 1e3 * at->tracking, 1e3 * at->last_tracking, 1e3 * at->miss, at->balance);
  }
  plot(svg, "set ylabel 'tip off the rigid arm [mm]'\nset title 'A flexible arm moves from point to point'\n",
       (const curve[]){{stiff, "1:(1000*$10)", "every ::1 with lines lw 2 lc rgb '#dd181f'", "stiff joints"},
                       {o.out, "1:(1000*$10)", "every ::1 with lines lw 2 lc rgb '#0060ad'", "strain damping"}},
       2, stdout);
  for (int k = 0; k < 2; k++) {
    check("energy - work of the motors + friction loss, of the work", r[k].balance / r[k].work,
          FB_SINGLE ? 1e-3 : 1e-5);
  }
  check("encoders while moving, stiff joints [rad]", r[0].tracking, 0.1);
  check("encoders at the end, strain damping [rad]", r[1].last_tracking, 1e-3);
  check("tip at the end off the rigid arm's with static sag, of the sag", r[1].miss / r[1].sag, 0.05);
  if (r[0].highest - r[0].lowest > 0.01) { /* a slow move hardly rings */
    check("ringing with strain damping, of that of stiff joints",
          (r[1].highest - r[1].lowest) / (r[0].highest - r[0].lowest), 0.25);
  }
  return misses != 0;
}
