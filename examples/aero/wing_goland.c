/* wing_goland - a wing that flutters: Goland's uniform cantilever, bending and torsion coupled by a mass axis behind the
   elastic axis, in incompressible flow by unsteady strip theory (airloads.h).
   The linear model holds the wing's coordinates and momenta and two states of the lag at each of its points: flutter is
   the speed at which an eigenvalue crosses the imaginary axis. The run steps the wing by fb_rk4_step between two half
   steps of the lag (order 2).
   Checks: frequencies at rest against closed forms without coupling; speed and frequency of flutter against the
   published 137.2 m/s and 70.7 rad/s (Goland 1945, Goland and Luke 1948) and against the continuous wing; growth of the
   run 5 % below and above that speed against the eigenvalues; the order of the step.
   Exit: 0 well, 1 a check failed or the motion left the model, 2 bad options or a file that cannot be written. */
#define _POSIX_C_SOURCE 200809L /* popen, for gnuplot */
#define FLEXBEAM_IMPLEMENTATION
#include "../../flexbeam.h"
#define PROGRAM "wing_goland"
#include "../common/check.h"
#include "../common/options.h"
#include "../common/output.h"
#include "../common/plot.h"
#include "airloads.h"
#include "goland.h"

enum { MODES = 4, MOST = 2 * FB_MAX_MODES + 2 * AIR_POINTS }; /* of a kind; states of the linear model */
typedef struct options {
  double density, modes;
  const char *out;
} options;

static fb_body wing;
static air flow;
static air_table thin;
static fb_input input;

static const char help[] =
    "wing_goland - flutter of Goland's wing by unsteady strip theory\n"
    "usage: wing_goland [options]\n"
    "  --density R     [kg/m^3] of the air; the published speed is for 1.225 (1.225)\n"
    "  --modes N       2 to 6, of bending and as many of torsion (4)\n"
    "  --out FILE      CSV: speed, growth [1/s] and frequency [rad/s] of the first two modes (wing_goland.csv);\n"
    "                  _runs.csv beside it: tip below and above the speed of flutter; a picture if gnuplot is there\n"
    "  --help          this text\n";

static int read_option(void *target, const char *name, const char *text)
{
  options *const o = target;
  const number_option numbers[] = {{"--density", &o->density, 0.1, 5}, {"--modes", &o->modes, 2, 6}};
  return strcmp(name, "--out") == 0 ? read_out(&o->out, text) : read_number(numbers, 2, name, text);
}

/* The wing is at rest, the air comes from ahead. */
static void set_air(double density, double speed)
{
  memset(&flow, 0, sizeof flow);
  flow.section = (air_section){&thin, chord, line, 1};
  flow.density = density;
  flow.wind[1] = -speed;
  input.distributed = air_loads;
  input.user = &flow;
}

/* ---- linear model */

/* Rates of z = (q, pi, states of the lag). */
static void rates(double *z_dot, const double *z)
{
  static fb_state state, rate;
  const int n = wing.n;
  need(fb_state_init(&wing, &state), "state");
  for (int i = 0; i < n; i++) {
    state.q[i] = (fb_real)z[i];
    state.pi[i] = (fb_real)z[n + i];
  }
  for (int i = 0; i < 2 * AIR_POINTS; i++) {
    flow.x[0][i / 2][i % 2] = z[2 * n + i];
  }
  need(fb_body_rates_eval(&wing, &rate, &state, &input), "rates");
  for (int i = 0; i < n; i++) {
    z_dot[i] = (double)rate.q[i];
    z_dot[n + i] = (double)rate.pi[i];
  }
  for (int i = 0; i < 2 * flow.n[0]; i++) {
    const int k = i / 2, l = i % 2;
    z_dot[2 * n + i] = air_jones_b[l] * flow.rate[0][k] * (air_jones_A[l] * flow.downwash[0][k] - flow.x[0][k][l]);
  }
}

/* Eigenvalues about the straight wing by central differences: the two vibrations [1/s], [rad/s] of the lowest
   frequency, and the largest real part of all. */
static double spectrum(double re[2], double im[2], double density, double speed)
{
  static double z[MOST], up[MOST], down[MOST];
  static fb_real A[MOST * MOST], X[2 * MOST * MOST], work[4 * MOST * MOST], all_re[MOST], all_im[MOST];
  const double width = FB_SINGLE ? 1e-2 : 1e-4;
  double largest = -1e300;
  int n;
  set_air(density, speed);
  memset(z, 0, sizeof z);
  rates(up, z);
  n = 2 * wing.n + 2 * flow.n[0];
  for (int j = 0; j < n; j++) {
    z[j] = width;
    rates(up, z);
    z[j] = -width;
    rates(down, z);
    z[j] = 0;
    for (int i = 0; i < n; i++) {
      A[i * n + j] = (fb_real)((up[i] - down[i]) / (2 * width));
    }
  }
  need(fb_eig_general_solve(all_re, all_im, X, A, work, n), "eigenvalues");
  im[0] = im[1] = 1e300;
  for (int k = 0; k < n; k++) {
    const double r = (double)all_re[k], w = (double)all_im[k];
    largest = fmax(largest, r);
    if (w > 10 && w < im[1]) { /* the lag has none */
      const int at = w < im[0] ? 0 : 1;
      im[1] = at == 0 ? im[0] : w;
      re[1] = at == 0 ? re[0] : r;
      im[0] = at == 0 ? w : im[0];
      re[0] = at == 0 ? r : re[0];
    }
  }
  return largest;
}

/* Speed of flutter by bisection; its frequency is that of the mode that grows. */
static double flutter(double *frequency, double density)
{
  double low = 60, high = 240, re[2], im[2];
  for (int k = 0; k < 40; k++) {
    const double speed = 0.5 * (low + high);
    *(spectrum(re, im, density, speed) > 0 ? &high : &low) = speed;
  }
  *frequency = re[0] > re[1] ? im[0] : im[1];
  return low;
}

/* ---- runs */

typedef struct run {
  fb_state state;
  double tip, peak, peak_time; /* [m] height of the tip; the last of its maxima */
  double first, first_time;    /* the first maximum of the second half of the run */
} run;

static double tip_height(const fb_state *state, const fb_motion *motion)
{
  fb_node_motion tip;
  need(fb_body_node_motion_eval(&wing, &tip, state, motion, 1), "tip");
  return (double)tip.displacement[2];
}

/* From a small deflection in steps dt: half a step of the lag, the wing with the lag held, half a step of the lag
   under the downwash that the wing then has. Every row-th step a tip height goes into rows. */
static void fly(run *r, double density, double speed, double seconds, double dt, double *rows, int row)
{
  static fb_rk4_work work;
  static fb_motion motion;
  const int steps = (int)lround(seconds / dt);
  double before = 0;
  memset(r, 0, sizeof *r);
  set_air(density, speed);
  need(fb_state_init(&wing, &r->state), "state");
  r->state.q[0] = FB_R(0.05);
  need(fb_body_motion_eval(&wing, &motion, &r->state, &input), "motion");
  for (int k = 0; k < steps; k++) {
    double now;
    if (rows && k % row == 0) {
      rows[k / row] = r->tip;
    }
    air_advance(&flow, 0.5 * dt);
    need(fb_rk4_step(&wing, &r->state, &work, &input, &input, &input, (fb_real)dt), "step");
    need(fb_body_motion_eval(&wing, &motion, &r->state, &input), "motion");
    air_advance(&flow, 0.5 * dt);
    now = tip_height(&r->state, &motion);
    if (r->tip > before && r->tip >= now) {
      r->peak = r->tip;
      r->peak_time = k * dt;
      r->first = k > steps / 2 && r->first_time == 0 ? r->peak : r->first;
      r->first_time = k > steps / 2 && r->first_time == 0 ? r->peak_time : r->first_time;
    }
    before = r->tip;
    r->tip = now;
  }
}

/* Observed order of the step: errors of all coordinates after a fifth of a second with two steps. */
static double order(double density, double speed)
{
  static run exact, coarse, fine;
  double miss[2] = {0};
  fly(&exact, density, speed, 0.2, 2.5e-5, NULL, 1);
  fly(&coarse, density, speed, 0.2, 4e-4, NULL, 1);
  fly(&fine, density, speed, 0.2, 2e-4, NULL, 1);
  for (int i = 0; i < wing.n; i++) {
    miss[0] = fmax(miss[0], fabs((double)(coarse.state.q[i] - exact.state.q[i])));
    miss[1] = fmax(miss[1], fabs((double)(fine.state.q[i] - exact.state.q[i])));
  }
  return log2(miss[0] / miss[1]);
}

/* ---- output */

static void draw(const char *out, const char *runs)
{
  char svg[512];
  FILE *gnuplot;
  other_name(svg, sizeof svg, out, ".svg");
  gnuplot = plot_begin(svg, 900, 800, stdout);
  if (gnuplot) {
    fputs("set multiplot layout 2,1\nset xlabel 'speed [m/s]'\nset ylabel 'growth [1/s]'\n", gnuplot);
    plot_curves(gnuplot,
                (const curve[]){{out, "1:2", "every ::1 with lines lw 2", "mode of lower frequency"},
                                {out, "1:4", "every ::1 with lines lw 2", "mode of higher frequency"}},
                2);
    fputs("set xlabel 'time [s]'\nset ylabel 'height of the tip [m]'\n", gnuplot);
    plot_curves(gnuplot,
                (const curve[]){{runs, "1:3", "every ::1 with lines", "5 % above the speed of flutter"},
                                {runs, "1:2", "every ::1 with lines lw 2", "5 % below"}},
                2);
    plot_end(gnuplot, svg, stdout);
  }
}

static int write_files(const options *o, const char *runs, const double *below, const double *above, int rows)
{
  FILE *file = output_open(o->out);
  if (!file) {
    return fail("cannot write", o->out);
  }
  fputs("speed,growth_1,frequency_1,growth_2,frequency_2\n", file);
  for (int speed = 10; speed <= 180; speed += 5) {
    double re[2], im[2];
    (void)spectrum(re, im, o->density, speed);
    fprintf(file, "%d,%.6g,%.6g,%.6g,%.6g\n", speed, re[0], im[0], re[1], im[1]);
  }
  if (output_close(file, o->out)) {
    return 2;
  }
  if (!(file = output_open(runs))) {
    return fail("cannot write", runs);
  }
  fputs("t,tip_below,tip_above\n", file);
  for (int k = 0; k < rows; k++) {
    fprintf(file, "%.6g,%.6g,%.6g\n", k * 2e-3, below[k], above[k]);
  }
  return output_close(file, runs);
}

int main(int argc, char **argv)
{
  enum { ROWS = 1000 };
  static double rows[2][ROWS];
  options o = {1.225, MODES, "wing_goland.csv"};
  char runs[512];
  double speed, frequency, exact[2], re[2], im[2];
  output_begin(PROGRAM);
  if (read_all(argc, argv, help, read_option, &o) != 0) {
    return 2;
  }
  air_table_plate(&thin, 2 * air_pi, 0.2, 0);
  goland_build(&wing, 0, (int)o.modes, 0);
  (void)spectrum(re, im, 0, 0);
  puts("at rest in vacuum, without the offset of the mass axis");
  check("bending, off 1.8751^2 sqrt(EI/m L^4) by", im[0] / (3.51602 * sqrt(EI / mass) / pow(semi_span, 2)) - 1, 1e-3);
  check("torsion, off pi/2 sqrt(GJ/I L^2) by",
        im[1] / (0.5 * air_pi * sqrt(GJ / (inertia - mass * behind * behind)) / semi_span) - 1, 1e-3);
  goland_build(&wing, o.density, (int)o.modes, behind);
  speed = flutter(&frequency, o.density);
  exact[0] = speed;
  exact[1] = frequency;
  goland_flutter(&exact[0], &exact[1], o.density);
  printf("flutter at %.3f m/s, %.3f rad/s; continuous wing %.3f m/s, %.3f rad/s; published %.1f m/s, %.1f rad/s\n",
         speed, frequency, exact[0], exact[1], published_speed, published_frequency);
  check("speed of flutter, off the continuous wing's by", speed / exact[0] - 1, 1e-3);
  check("frequency of flutter, off the continuous wing's by", frequency / exact[1] - 1, 1e-3);
  if (o.density == 1.225) {
    check("speed of flutter, off the published by", speed / published_speed - 1, 0.02);
    check("frequency of flutter, off the published by", frequency / published_frequency - 1, 0.02);
  }
  for (int k = 0; k < 2; k++) {
    static run r;
    const double at = (k ? 1.05 : 0.95) * speed;
    double growth;
    (void)spectrum(re, im, o.density, at);
    fly(&r, o.density, at, 2, 5e-4, rows[k], 4);
    growth = log(r.peak / r.first) / (r.peak_time - r.first_time);
    printf("run at %.2f m/s: growth %.3f 1/s, eigenvalue %.3f 1/s\n", at, growth, fmax(re[0], re[1]));
    check(k ? "above the speed of flutter it grows: lack of growth" : "below the speed of flutter it decays: growth",
          fmax(0, k ? -growth : growth), 0);
    check("growth off the eigenvalue by [1/s]", growth - fmax(re[0], re[1]), 0.01);
  }
  check("order of the step, off 2 by", order(o.density, speed) - 2, 0.1);
  other_name(runs, sizeof runs, o.out, "_runs.csv");
  if (write_files(&o, runs, rows[0], rows[1], ROWS)) {
    return 2;
  }
  printf("curves: %s, %s\n", o.out, runs);
  draw(o.out, runs);
  return misses != 0;
}
