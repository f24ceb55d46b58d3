/* spacecraft - a slew with flexible solar arrays, without and with a notch filter in the attitude loop.
   A free hub carries two arrays on drives, along +y and -y of the hub. Gyros and a star tracker on the hub feed a PD
   controller, whose torque command passes a roll-off filter (it keeps the noise of the sensors off the wheels) and, in
   the second run, a notch at the frequency at which hub and arrays swing against each other. The roll-off turns the
   phase at that frequency so far that the loop feeds the arrays; without the notch the torque limit alone stops them.
   Checks: that frequency, in closed form and of the linear model; angular momentum against the impulse of the torque;
   energy against work and dissipation; the error at the end with the notch, and the arrays' residual swing.
   Exit: 0 well, 1 a check failed or the motion left the model, 2 bad options or a file that cannot be written. */
#define _POSIX_C_SOURCE 200809L /* popen, for gnuplot */
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#define PROGRAM "spacecraft"
#include "common/check.h"
#include "common/balance.h"
#include "common/filter.h"
#include "common/options.h"
#include "common/output.h"
#include "common/plot.h"
#include "common/solar_array.h"

static const double pi = 3.14159265358979324, degree = 3.14159265358979324 / 180.0;
static const double period = 0.01, dt = 0.002, duration = 40; /* [s] of the controller, of a step, of the slew */

enum { HUB, RIGHT, LEFT, BODIES };       /* of the system */
enum { HUB_MODEL, ARRAY_MODEL, MODELS }; /* the arrays share one */

typedef struct options {
  double angle, t_end, notch; /* [deg], [s], - */
  const char *out;
} options;

static const char help[] =
    "spacecraft - slew of a hub with two flexible solar arrays, without and with a notch filter\n"
    "usage: spacecraft [options]\n"
    "  --angle A        [deg] slew about x of the hub in 40 s, 0.001 to 180 (30)\n"
    "  --t-end T        [s] end of the runs, at least 60 (120)\n"
    "  --notch R        center of the notch, relative to the frequency it is for (1; too low is forgiven)\n"
    "  --out FILE       CSV of both runs; beside it a picture (SVG) when gnuplot is there (spacecraft.csv)\n"
    "  --help           this text\n"
    "A controller that does not fit its craft fails the checks at the end.\n";

static int read_option(void *target, const char *name, const char *text)
{
  options *const o = target;
  const number_option numbers[] = {
      {"--angle", &o->angle, 1e-3, 180}, {"--t-end", &o->t_end, 60, 1e4}, {"--notch", &o->notch, 1e-3, 1e3}};
  return strcmp(name, "--out") == 0 ? read_out(&o->out, text) : read_number(numbers, 3, name, text);
}

/* ---- the model */

static const solar_array array = {8, 2, 1, 30, 0.25, 0.005, 0};
static double inertia[3] = {1000, 800, 1100}; /* [kg m^2] of the hub, then of the whole, undeformed */
static fb_beam beam;
static fb_modes modes;
static int tip; /* node of the arrays */
static fb_body model[MODELS];
static fb_system craft;
static fb_system_work work;

static void make_craft(void)
{
  static fb_build_work scratch;
  const fb_build_desc hub = {.mass = 1200,
                             .inertia = {(fb_real)inertia[0], (fb_real)inertia[1], (fb_real)inertia[2]},
                             .body = {.base = FB_BASE_PRESCRIBED}};
  fb_system_desc desc = {.n_body = BODIES,
                         .model = {HUB_MODEL, ARRAY_MODEL, ARRAY_MODEL},
                         .joint = {{.kind = FB_JOINT_FREE, .parent = FB_GROUND}}};
  need(fb_body_build(&model[HUB_MODEL], &scratch, &hub, NULL, NULL, 0), "hub");
  need(solar_array_init(&model[ARRAY_MODEL], &tip, &beam, &modes, &array), "array");
  for (int k = RIGHT; k <= LEFT; k++) {
    solar_array_hang(&desc.joint[k], &array, k == RIGHT ? 1 : -1);
    desc.joint[k].mode[0] = FB_AXIS_PRESCRIBED;
  }
  need(fb_system_init(&craft, &work, model, &desc, MODELS), "system");
  solar_array_add_inertia(inertia, &array);
}

/* ---- a run */

enum { TORQUE, DRIVES, LOST, FLOWS }; /* power of the torque and of the drives, what the modes lose */

typedef struct scene {
  int with_notch;
  filter roll_off[3], notch[3]; /* of each axis */
  fb_system_state state;
  fb_system_input input;
  fb_system_motion motion;
  balance balance;
  double sum[FLOWS];                       /* [J] since the beginning */
  double turned, passed;                   /* [N m s], [J] integrals of |torque| and |its power| */
  double error, low[BODIES], high[BODIES]; /* in the last 10 s: largest error [rad], range of the tips [m] */
} scene;

/* Torque on the hub, in its axes, and where the drives are at time t: at 0.06 deg/s, as in low orbit, the same way
   about y of the hub. */
static void set_input(fb_system_input *input, double t, const double torque[3])
{
  const double rate = 0.06 * degree;
  memset(input, 0, sizeof *input);
  input->n_load = 1;
  input->load[0].body = HUB;
  input->load[0].load.axes = FB_AXES_BODY;
  for (int i = 0; i < 3; i++) {
    input->load[0].load.torque[i] = (fb_real)torque[i];
  }
  for (int k = RIGHT; k <= LEFT; k++) {
    input->drive[k].value[0] = (fb_real)((k == RIGHT ? 1 : -1) * rate * t);
    input->drive[k].rate[0] = (fb_real)((k == RIGHT ? 1 : -1) * rate);
  }
}

/* The hub at rest where the slew begins, the drives turning. w: [rad/s] of the notch. */
static void begin(scene *s, double w, int with_notch)
{
  const double r = 2 * pi * 0.4; /* [rad/s] of the roll-off */
  fb_link_motion start[BODIES] = {{.q = {0}}};
  memset(s, 0, sizeof *s);
  s->with_notch = with_notch;
  for (int i = 0; i < 3; i++) {
    filter_init(&s->roll_off[i], 0, 0, r * r, 2 * 0.7 * r, r * r, r, period);
    filter_init(&s->notch[i], 1, 2 * 0.02 * w, w * w, 2 * 0.5 * w, w * w, w, period);
  }
  set_input(&s->input, 0, (const double[3]){0});
  for (int k = RIGHT; k <= LEFT; k++) {
    start[k].speed[0] = s->input.drive[k].rate[0];
  }
  need(fb_system_state_init(&craft, model, &s->state, &work, start, &s->input), "initial state");
  balance_begin(&s->balance, &craft, model, &work, &s->state, &s->input);
  need(fb_system_motion_eval(&craft, model, &work, &s->motion, &s->state, &s->input), "motion");
}

/* [W] at this instant; the modes lose 2 zeta omega q_dot^2. */
static void flow(double f[FLOWS], const scene *s)
{
  f[TORQUE] = f[LOST] = 0;
  f[DRIVES] = (double)s->motion.power;
  for (int i = 0; i < 3; i++) {
    f[TORQUE] += (double)(s->input.load[0].load.torque[i] * s->motion.motion[HUB].w[i]);
  }
  for (int k = RIGHT; k <= LEFT; k++) {
    for (int a = 0; a < modes.n; a++) {
      const double q_dot = (double)s->motion.motion[k].q_dot[a];
      f[LOST] += 2 * array.damping * (double)modes.omega[a] * q_dot * q_dot;
    }
  }
}

/* One step with the torque held; work by the trapezoidal rule. */
static void advance(scene *s, double t, const double torque[3])
{
  static fb_system_input middle, end;
  const fb_link_state hub = s->state.link[HUB];
  double before[FLOWS], after[FLOWS];
  flow(before, s);
  set_input(&middle, t + 0.5 * dt, torque);
  set_input(&end, t + dt, torque);
  need(fb_system_rk4_step(&craft, model, &s->state, &work, &s->input, &middle, &end, (fb_real)dt), "step");
  s->input = end;
  need(fb_system_motion_eval(&craft, model, &work, &s->motion, &s->state, &s->input), "motion");
  flow(after, s);
  for (int i = 0; i < FLOWS; i++) {
    s->sum[i] += 0.5 * dt * (before[i] + after[i]);
  }
  s->balance.work = s->sum[TORQUE] + s->sum[DRIVES] - s->sum[LOST];
  balance_add_torque(&s->balance, torque, hub.quat, s->state.link[HUB].quat, dt);
  s->passed += 0.5 * dt * fabs(before[TORQUE] + after[TORQUE]);
  s->turned += dt * sqrt(torque[0] * torque[0] + torque[1] * torque[1] + torque[2] * torque[2]);
}

/* Torque command of the next period [N m], at 0.4 rad/s with damping ratio 0.8, at most 10 N m, along a slew about x
   whose rate is a versine. error: the small rotation [rad] from where the hub should be to where it is, body axes:
   2 vec(conj(q_ref) o q). */
static void command(scene *s, double torque[3], double error[3], const options *o, double t,
                    const fb_node_motion *sensors)
{
  const double bandwidth = 0.4, limit = 10, A = o->angle * degree, T = duration, x = 2 * pi * fmin(t / T, 1);
  const double rate[3] = {A * (1 - cos(x)) / T, 0, 0}, acceleration[3] = {A * 2 * pi * sin(x) / (T * T), 0, 0};
  const fb_real back[3] = {(fb_real)(A * (sin(x) - x) / (2 * pi)), 0, 0};
  fb_real inverse[4], e[4];
  fb_imu imu;
  fb_imu_eval(&imu, sensors, NULL);
  fb_quat_from_rotvec(inverse, back);
  fb_quat_mul(e, inverse, sensors->quat);
  for (int i = 0; i < 3; i++) {
    const double J = inertia[i], kp = J * bandwidth * bandwidth, kd = 2 * 0.8 * J * bandwidth;
    double u;
    error[i] = (e[0] < 0 ? -2 : 2) * (double)e[i + 1];
    u = J * acceleration[i] - kp * error[i] - kd * ((double)imu.angular_rate[i] - rate[i]);
    u = filter_step(&s->roll_off[i], u);
    u = s->with_notch ? filter_step(&s->notch[i], u) : u;
    torque[i] = fmax(-limit, fmin(limit, u));
  }
}

/* A period of the controller, which begins at t; row: of the CSV, NULL for none. */
static void run_period(scene *s, const options *o, double t, FILE *row)
{
  double torque[3], error[3];
  fb_node_motion sensors;
  need(fb_body_node_motion_eval(&model[HUB_MODEL], &sensors, s->motion.pose, s->motion.motion, 0), "sensors");
  command(s, torque, error, o, t, &sensors);
  if (row) {
    const double off = sqrt(error[0] * error[0] + error[1] * error[1] + error[2] * error[2]);
    const int last = t >= o->t_end - 10;
    fprintf(row, ",%.8g", off / degree);
    s->error = last ? fmax(s->error, off) : 0;
    for (int k = RIGHT; k <= LEFT; k++) {
      fb_node_motion at;
      need(fb_body_node_motion_eval(&model[ARRAY_MODEL], &at, &s->motion.pose[k], &s->motion.motion[k], tip), "tip");
      fprintf(row, ",%.8g", (double)at.displacement[2]);
      s->low[k] = last ? fmin(s->low[k], (double)at.displacement[2]) : HUGE_VAL;
      s->high[k] = last ? fmax(s->high[k], (double)at.displacement[2]) : -HUGE_VAL;
    }
    fprintf(row, ",%.8g", torque[0]);
    balance_look(&s->balance, &craft, model, &work, &s->state, &s->input);
  }
  set_input(&s->input, t, torque);
  need(fb_system_motion_eval(&craft, model, &work, &s->motion, &s->state, &s->input), "motion with the new torque");
  for (int i = 0; i < (int)(period / dt + 0.5) && t < o->t_end - 0.5 * period; i++) {
    advance(s, t + i * dt, torque);
  }
}

/* The frequency [rad/s] at which the free craft swings: that of its linear model which is nearest to w. */
static double model_swing(double w)
{
  static fb_system_analyse_work analyse_work;
  static fb_spectrum spectrum;
  static fb_system_state state;
  double nearest = 0;
  need(fb_system_state_init(&craft, model, &state, &work, NULL, NULL), "state at rest");
  need(fb_system_spectrum_solve(&craft, model, &analyse_work, &spectrum, &state, NULL), "complex modes");
  for (int k = 0; k < spectrum.n; k++) {
    nearest = fabs((double)spectrum.im[k] - w) < fabs(nearest - w) ? (double)spectrum.im[k] : nearest;
  }
  return nearest;
}

int main(int argc, char **argv)
{
  static scene s[2]; /* without and with a notch */
  options o = {30, 120, 1, "spacecraft.csv"};
  double swing, measured, range[2];
  char svg[512];
  FILE *file;
  output_begin(PROGRAM);
  if (read_all(argc, argv, help, read_option, &o) != 0) {
    return 2;
  }
  if (!(file = output_open(o.out))) {
    return fail("cannot write", o.out);
  }
  make_craft();
  swing = solar_array_swing(&modes, &array, inertia[0]);
  measured = model_swing(swing);
  printf("array clamped %.4f Hz; hub and arrays swing at %.4f Hz by the closed form, at %.4f Hz in the model\n",
         array.frequency, swing / (2 * pi), measured / (2 * pi));
  fprintf(file, "t,error_deg,tip_right,tip_left,torque,notch_error_deg,notch_tip_right,notch_tip_left,notch_torque\n");
  begin(&s[0], swing, 0);
  begin(&s[1], o.notch * swing, 1);
  for (int n = 0; n <= (int)(o.t_end / period + 0.5); n++) { /* both runs side by side, a row every 0.1 s */
    FILE *const row = n % 10 ? NULL : file;
    if (row) {
      fprintf(row, "%s%.10g", n ? "\n" : "", n * period);
    }
    run_period(&s[0], &o, n * period, row);
    run_period(&s[1], &o, n * period, row);
  }
  fputc('\n', file);
  if (output_close(file, o.out)) {
    return 2;
  }
  for (int k = 0; k < 2; k++) {
    range[k] = 0.5 * fmax(s[k].high[RIGHT] - s[k].low[RIGHT], s[k].high[LEFT] - s[k].low[LEFT]);
    printf(
        "%-8s notch: last 10 s: error up to %.3g deg, tips swing by %.3g m; work of the torque %.4g J, lost %.4g J\n",
        k ? "with" : "without", s[k].error / degree, range[k], s[k].sum[TORQUE], s[k].sum[LOST]);
  }
  printf("curves: %s\n", o.out);
  other_name(svg, sizeof svg, o.out, "_error.svg");
  plot(svg,
       "set logscale y\nset format y '10^{%L}'\nset ylabel 'pointing error [deg]'\n"
       "set title 'Slew of a spacecraft with flexible arrays: distance from the commanded attitude'\n",
       (const curve[]){{o.out, "1:2", "every ::1 with lines lw 1.5 lc rgb '#dd181f'", "without notch"},
                       {o.out, "1:6", "every ::1 with lines lw 2 lc rgb '#0060ad'", "with notch"}},
       2, stdout);
  check("swing frequency, closed form against model", fabs(measured / swing - 1), 5e-3);
  for (int k = 0; k < 2; k++) {
    const double *const H = s[k].balance.momentum_miss, part = FB_SINGLE ? 1e-4 : 1e-7;
    check("angular momentum less impulse, part of all impulses", fmax(H[0], fmax(H[1], H[2])) / s[k].turned, part);
    check("energy less work and loss, part of all work", s[k].balance.energy_miss / s[k].passed,
          FB_SINGLE ? 1e-3 : 1e-5);
  }
  check("with notch: error in the last 10 s [deg]", s[1].error / degree, 0.01);
  check("with notch: swing of the tips, part of that without", range[1] / range[0], 0.1);
  return misses != 0;
}
