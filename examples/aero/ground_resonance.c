/* ground_resonance - a rotor whose blades are hinged for lag, on a support that gives way in the plane of rotation:
   the blades' mass center whirls at less than the rotor's speed, and where that meets the support's frequency both grow.
   Rigid blades on revolute joints; hub and support slide on two springs, alike in both directions.
   The linear model has the slides turn with the hub: there the system does not change with time. The run has them fixed
   on the ground, and is seen in multiblade coordinates.
   Checks: the range of unstable speeds without dampers, and growth within it, by fb_system_spectrum_solve against the
   characteristic equation of R. P. Coleman and A. M. Feingold (NACA report 1351, 1958); growth of runs without and with
   dampers against that equation; below and above the range the run does not grow.
   Exit: 0 well, 1 a check failed or the motion left the model, 2 bad options or a file that cannot be written. */
#define _POSIX_C_SOURCE 200809L  /* popen, for gnuplot */
#include "../tools/capacities.h" /* of build/flexbeam: larger models than by default */
#define FLEXBEAM_IMPLEMENTATION
#include "../../flexbeam.h"
#define PROGRAM "ground_resonance"
#include "../common/check.h"
#include "../common/options.h"
#include "../common/output.h"
#include "../common/plot.h"
#include "coleman.h"
#include "multiblade.h"

enum { MOST = 6, FIRST = 3 }; /* blades; the first of them among the bodies */
enum { NOTHING, CARRIAGE, BLADE, MODELS };
static const double pi = 3.14159265358979324;
static fb_body model[MODELS];
static fb_system rotor;
static fb_system_work work;

static const char help[] =
    "ground_resonance - unstable speeds of a rotor with lag hinges on a flexible support\n"
    "usage: ground_resonance [options]\n"
    "  --blades N      3 to 6 (4)\n"
    "  --offset E      [m] of the lag hinges (0.3)\n"
    "  --length L      [m] of a blade, uniform, from its hinge (5)\n"
    "  --blade-mass M  [kg] (25)\n"
    "  --mass M        [kg] of hub and support (1500)\n"
    "  --frequency W   [rad/s] of the support that carries the rotor (20)\n"
    "  --lag-damper D  [N m s/rad] on each hinge in the damped run (900)\n"
    "  --damping C     [N s/m] of the support in the damped run (1500)\n"
    "  --out FILE      CSV: speed, growth, its closed form (ground_resonance.csv); _runs.csv beside it: the support "
    "and\n"
    "                  the lag of the blades in multiblade coordinates; a picture if gnuplot is there\n"
    "  --help          this text\n";

typedef struct options {
  coleman_rotor rotor;
  const char *out;
} options;

static int read_option(void *target, const char *name, const char *text)
{
  coleman_rotor *const o = &((options *)target)->rotor;
  const number_option numbers[] = {{"--blades", &o->blades, 3, MOST},
                                   {"--offset", &o->offset, 0.01, 2},
                                   {"--length", &o->length, 0.1, 20},
                                   {"--blade-mass", &o->blade_mass, 0.1, 1e3},
                                   {"--mass", &o->mass, 1, 1e6},
                                   {"--frequency", &o->frequency, 1, 200},
                                   {"--lag-damper", &o->lag_damper, 0, 1e6},
                                   {"--damping", &o->damping, 0, 1e6}};
  return strcmp(name, "--out") == 0 ? read_out(&((options *)target)->out, text) : read_number(numbers, 8, name, text);
}

/* ---- the model */

/* The carriage carries the mass of hub and support; slide and hub have none. `turning`: the hub turns on the ground and
   the slides turn with it; else the slides are fixed on the ground, with the dampers. Blade k is body FIRST + k. */
static void build(const coleman_rotor *o, int turning, int damped)
{
  static fb_build_work scratch;
  const int hub = turning ? 0 : 2, slide = turning ? 1 : 0, carriage = slide + 1;
  const fb_real m = (fb_real)o->blade_mass, L = (fb_real)o->length, thin = m * L * L / 12;
  const fb_body_desc held = {.base = FB_BASE_PRESCRIBED};
  const fb_build_desc bodies[MODELS] = {
      {.body = held},
      {.mass = (fb_real)o->mass, .inertia = {1, 1, 1}, .body = held},
      {.mass = m, .center = {L / 2}, .inertia = {thin / 1000, thin, thin}, .body = held}};
  const double M = coleman_mass(o), K = M * o->frequency * o->frequency;
  const int blades = (int)o->blades;
  fb_system_desc desc = {.n_body = FIRST + blades, .model = {NOTHING}};
  for (int k = 0; k < MODELS; k++) {
    need(fb_body_build(&model[k], &scratch, &bodies[k], NULL, NULL, 0), "body");
  }
  desc.model[carriage] = CARRIAGE;
  desc.joint[hub] = (fb_joint_desc){.kind = FB_JOINT_REVOLUTE, .parent = hub - 1, .mode = {FB_AXIS_PRESCRIBED}};
  for (int i = 0; i < 2; i++) {
    desc.joint[slide + i] = (fb_joint_desc){.kind = FB_JOINT_PRISMATIC,
                                            .parent = slide + i - 1,
                                            .stiffness = {(fb_real)K},
                                            .damping = {(fb_real)(damped ? o->damping : 0)}};
    desc.joint[slide + i].axis[i] = 1;
  }
  for (int k = 0; k < blades; k++) {
    fb_joint_desc *const hinge = &desc.joint[FIRST + k];
    const double psi = 2 * pi * k / blades;
    const fb_real phi[3] = {0, 0, (fb_real)psi};
    desc.model[FIRST + k] = BLADE;
    hinge->kind = FB_JOINT_REVOLUTE;
    hinge->parent = FIRST - 1;
    hinge->position[0] = (fb_real)(o->offset * cos(psi));
    hinge->position[1] = (fb_real)(o->offset * sin(psi));
    hinge->damping[0] = (fb_real)(damped ? o->lag_damper : 0);
    fb_quat_from_rotvec(hinge->attitude, phi);
  }
  need(fb_system_init(&rotor, &work, model, &desc, MODELS), "system");
}

static void drive(fb_system_input *input, int hub, double W, double t)
{
  input->drive[hub].value[0] = (fb_real)fmod(W * t, 2 * pi);
  input->drive[hub].rate[0] = (fb_real)W;
}

/* Growth rate [1/s] by the library about the rotor that turns steadily. */
static double linear_growth(double W)
{
  static fb_system_analyse_work analyse;
  static fb_spectrum spectrum;
  static fb_system_state state;
  static fb_system_input input;
  fb_link_motion start[FB_MAX_BODIES] = {{.q = {0}}};
  double most = -1e300;
  drive(&input, 0, W, 0);
  start[0].speed[0] = input.drive[0].rate[0];
  need(fb_system_state_init(&rotor, model, &state, &work, start, &input), "state");
  need(fb_system_spectrum_solve(&rotor, model, &analyse, &spectrum, &state, &input), "spectrum");
  for (int k = 0; k < spectrum.n; k++) {
    most = fmax(most, (double)spectrum.re[k]);
  }
  return most;
}

/* The speeds between which it is unstable without dampers: by bisection from a speed where it is. */
static void range(double edge[2], const coleman_rotor *o, int closed)
{
  double middle = 0, highest = 0;
  for (int k = 1; k <= 400; k++) { /* where it grows most */
    const double W = 0.01 * k * o->frequency, growth = coleman_growth(o, W, 0);
    middle = growth > highest ? W : middle;
    highest = fmax(highest, growth);
  }
  for (int side = 0; side < 2; side++) {
    double stable = side ? 5 * o->frequency : 0.2 * o->frequency, unstable = middle;
    for (int k = 0; k < 30; k++) {
      const double W = 0.5 * (stable + unstable);
      *((closed ? coleman_growth(o, W, 0) : linear_growth(W)) > 1e-4 * o->frequency ? &unstable : &stable) = W;
    }
    edge[side] = stable;
  }
}

/* ---- a run on the ground */

/* Growth rate [1/s] of the whirl of the blades' mass center after the hub was pushed, over the second half. */
static double run(const coleman_rotor *o, double W, double seconds, FILE *file)
{
  static fb_system_state state;
  static fb_system_input input, middle, end;
  static fb_system_motion motion;
  const int steps = (int)(seconds * W / (2 * pi) * 100), hub = 2; /* a hundred a revolution */
  const double dt = seconds / steps;
  fb_link_motion start[FB_MAX_BODIES] = {{.q = {0}}};
  double sum[4] = {0}; /* of a straight line through the logarithms of the whirl: 1, t, log, t log; t from its middle */
  double square = 0;
  memset(&input, 0, sizeof input);
  drive(&input, hub, W, 0);
  start[hub].speed[0] = input.drive[hub].rate[0];
  start[0].value[0] = FB_R(1e-6);
  need(fb_system_state_init(&rotor, model, &state, &work, start, &input), "state");
  for (int k = 0; k <= steps; k++) {
    const double t = k * dt;
    double lag[MOST];
    multiblade all;
    drive(&input, hub, W, t);
    need(fb_system_motion_eval(&rotor, model, &work, &motion, &state, &input), "motion");
    for (int i = 0; i < (int)o->blades; i++) {
      lag[i] = (double)motion.joint[FIRST + i].value[0];
    }
    all = multiblade_of(lag, (int)o->blades, fmod(W * t, 2 * pi));
    if (k > steps / 2) {
      const double at = t - 0.75 * seconds, size = 0.5 * log(all.cosine * all.cosine + all.sine * all.sine);
      sum[0] += 1;
      sum[1] += at;
      sum[2] += size;
      sum[3] += at * size;
      square += at * at;
    }
    if (file && k % 5 == 0) {
      fprintf(file, "%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g\n", t, (double)motion.joint[0].value[0],
              (double)motion.joint[1].value[0], all.mean, all.cosine, all.sine, lag[0]);
    }
    drive(&middle, hub, W, t + 0.5 * dt);
    drive(&end, hub, W, t + dt);
    need(fb_system_rk4_step(&rotor, model, &state, &work, &input, &middle, &end, (fb_real)dt), "step");
  }
  return (sum[3] - sum[1] * sum[2] / sum[0]) / (square - sum[1] * sum[1] / sum[0]);
}

static void draw(const char *out, const char *runs)
{
  const curve growth[] = {{out, "1:3", "every ::1 with lines lw 3 lc rgb '#cccccc'", "Coleman and Feingold"},
                          {out, "1:2", "every ::1 with points pt 7 ps 0.4", "linear model"}};
  const curve whirl[] = {{runs, "1:5", "every ::1 with lines", "lag, cosine"},
                         {runs, "1:7", "every ::1 with lines", "lag, a blade"}};
  char svg[512];
  FILE *gnuplot;
  other_name(svg, sizeof svg, out, ".svg");
  gnuplot = plot_begin(svg, 900, 800, stdout);
  if (gnuplot) {
    fputs("set multiplot layout 2,1\nset xlabel 'speed [rad/s]'\nset ylabel 'growth [1/s]'\n", gnuplot);
    plot_curves(gnuplot, growth, 2);
    fputs("set xlabel 'time [s]'\nset ylabel 'angle [rad]'\n", gnuplot);
    plot_curves(gnuplot, whirl, 2);
    plot_end(gnuplot, svg, stdout);
  }
}

/* Growth by both models over the speeds. */
static int write_sweep(const char *out, const coleman_rotor *o, const double edge[2])
{
  FILE *file = output_open(out);
  if (!file) {
    return fail("cannot write", out);
  }
  fputs("speed,growth,closed_form\n", file);
  for (int k = 0; k <= 100; k++) {
    const double W = 0.8 * edge[0] + (1.2 * edge[1] - 0.8 * edge[0]) * k / 100;
    fprintf(file, "%.6g,%.6g,%.6g\n", W, linear_growth(W), coleman_growth(o, W, 0));
  }
  return output_close(file, out);
}

int main(int argc, char **argv)
{
  options all = {{4, 0.3, 5, 25, 1500, 20, 900, 1500}, "ground_resonance.csv"};
  const coleman_rotor *const o = &all.rotor;
  double edge[2], exact[2], middle, growth, damped;
  char runs[512];
  FILE *file;
  output_begin(PROGRAM);
  if (read_all(argc, argv, help, read_option, &all) != 0) {
    return 2;
  }
  build(o, 1, 0);
  range(edge, o, 0);
  range(exact, o, 1);
  middle = 0.5 * (exact[0] + exact[1]);
  printf("unstable from %.4f to %.4f rad/s; closed form %.4f to %.4f\n", edge[0], edge[1], exact[0], exact[1]);
  check("lower end, off the closed form by", edge[0] / exact[0] - 1, 1e-4);
  check("upper end, off the closed form by", edge[1] / exact[1] - 1, 1e-4);
  check("growth in the middle, off the closed form by", linear_growth(middle) / coleman_growth(o, middle, 0) - 1, 1e-4);
  if (write_sweep(all.out, o, edge)) {
    return 2;
  }
  other_name(runs, sizeof runs, all.out, "_runs.csv");
  if (!(file = output_open(runs))) {
    return fail("cannot write", runs);
  }
  build(o, 0, 0);
  fputs("t,x,y,lag_mean,lag_cosine,lag_sine,lag_blade\n", file);
  growth = run(o, middle, 10 / coleman_growth(o, middle, 0), file);
  if (output_close(file, runs)) {
    return 2;
  }
  printf("run at %.3f rad/s: growth %.4f 1/s, closed form %.4f\n", middle, growth, coleman_growth(o, middle, 0));
  check("growth of the run, off the closed form by", growth / coleman_growth(o, middle, 0) - 1, 0.01);
  check("growth of a run 5 % below the range [1/s]", run(o, 0.95 * exact[0], 100, NULL), 0.01);
  check("growth of a run 5 % above the range [1/s]", run(o, 1.05 * exact[1], 100, NULL), 0.01);
  build(o, 0, 1);
  damped = coleman_growth(o, middle, 1);
  growth = run(o, middle, fmin(60, 10 / fabs(damped)), NULL);
  printf("run with dampers: growth %.4f 1/s, closed form %.4f\n", growth, damped);
  if (damped > 0) { /* else no motion stands out for long */
    check("growth with dampers, off the closed form by", growth / damped - 1, 0.01);
  } else {
    check("growth with dampers, which prevent it [1/s]", fmax(0, growth), 0);
  }
  printf("curves: %s, %s\n", all.out, runs);
  draw(all.out, runs);
  return misses != 0;
}
