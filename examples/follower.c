/* follower - forces that turn with the tip of a cantilever, of which [L] 4.4 has one: 1000 lb across a beam of 72 in.
   First the force across the tip, growing: it never holds the beam back, the tip goes round. Then the same force along
   the tip, pressing: no bent state exists, and yet at 20.05 EI/L^2 the column begins to flutter (Beck), which a static
   analysis cannot see; the frequencies about the straight state can.
   Checks: the bent beam against its own differential equation, integrated from the tip; Beck's load.
   Exit: 0 well, 1 a check failed, 2 bad options. */
#define _POSIX_C_SOURCE 200809L /* popen, for gnuplot */
#include "tools/capacities.h"   /* of build/flexbeam: larger models than by default */
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#define PROGRAM "follower"
#include "common/options.h"
#include "common/output.h"
#include "common/exact_beam.h"
#include "common/plot.h"

typedef struct options {
  double length, EI, EA, GA, mass, force, elements;
  const char *out;
} options;

static const char help[] =
    "follower - forces that turn with the tip of a cantilever: large deflection, and flutter; any consistent units\n"
    "usage: follower [options]\n"
    "  --length L     (72 in)\n"
    "  --ei EI        (5e6 lb in^2)\n"
    "  --ea EA        0: rigid (6e7 lb)\n"
    "  --ga GA        0: rigid (2.2222e7 lb)\n"
    "  --mass M       per length (0.001522 lb s^2/in^2)\n"
    "  --force F      largest force across the tip (1000 lb)\n"
    "  --elements N   2 to 400 (40)\n"
    "  --out FILE     CSV of the shapes by tenths of the force (follower.csv); beside it _flutter.csv, the first two\n"
    "                 frequencies by the pressing force; pictures\n"
    "  --help         this text\n";

static int read_option(void *target, const char *name, const char *text)
{
  options *const o = target;
  const number_option numbers[] = {{"--length", &o->length, 1e-9, 1e9},
                                   {"--ei", &o->EI, 1e-30, 1e30},
                                   {"--ea", &o->EA, 0, 1e30},
                                   {"--ga", &o->GA, 0, 1e30},
                                   {"--mass", &o->mass, 1e-30, 1e30},
                                   {"--force", &o->force, 0, 1e30},
                                   {"--elements", &o->elements, 2, FB_MAX_EXACT}};
  return strcmp(name, "--out") == 0 ? read_out(&o->out, text) : read_number(numbers, 7, name, text);
}

static void build(const options *o)
{
  const double stiffness[6] = {o->EA, o->GA, o->GA, 0, 0, o->EI};
  const double inertia[6] = {o->mass, o->mass, o->mass, 0, 0, 0};
  beam_uniform(o->length, (int)o->elements, stiffness, inertia);
}

/* ---- the exact bent beam */

/* N' = k Q, Q' = -k N, M' = -(1 + N/EA) Q + Q N/GA with k = M/EI, and the line itself, from the tip inwards. */
static void slope(double d[6], const double y[6], const options *o)
{
  const double N = y[0], Q = y[1], k = y[2] / o->EI;
  const double e = 1 + (o->EA > 0 ? N / o->EA : 0), g = o->GA > 0 ? Q / o->GA : 0;
  d[0] = k * Q;
  d[1] = -k * N;
  d[2] = -e * Q + g * N;
  d[3] = e * cos(y[5]) - g * sin(y[5]);
  d[4] = e * sin(y[5]) + g * cos(y[5]);
  d[5] = k;
}

/* Tip seen from the root (x, y, rotation) by Runge-Kutta of order 4: an initial value problem, no shooting. */
static void exact_tip(double tip[3], const options *o)
{
  const int n = 4000;
  const double h = -o->length / n;
  double y[6] = {0, o->force, 0, 0, 0, 0};
  for (int k = 0; k < n; k++) {
    double d[4][6], at[6];
    slope(d[0], y, o);
    for (int s = 1; s < 4; s++) {
      for (int i = 0; i < 6; i++) {
        at[i] = y[i] + (s == 3 ? h : h / 2) * d[s - 1][i];
      }
      slope(d[s], at, o);
    }
    for (int i = 0; i < 6; i++) {
      y[i] += h / 6 * (d[0][i] + 2 * d[1][i] + 2 * d[2][i] + d[3][i]);
    }
  }
  tip[0] = -y[3] * cos(y[5]) - y[4] * sin(y[5]); /* the root is at y[3], y[4], turned by y[5] */
  tip[1] = y[3] * sin(y[5]) - y[4] * cos(y[5]);
  tip[2] = -y[5];
}

static fb_status bend(const options *o, FILE *csv)
{
  const int n = (int)o->elements;
  fb_status status;
  build(o);
  status = beam_start();
  printf("force across the tip, turning with it\n");
  printf("force        tip x        tip y        rotation [rad]  root N       root Q       root M\n");
  for (int tenth = 1; tenth <= 10 && status == FB_OK; tenth++) {
    beam_input.n_load = 0;
    beam_tip_load(FB_AXES_NODE)->force[1] = (fb_real)(o->force * tenth / 10);
    status = beam_settle();
    if (status == FB_OK) {
      const fb_exact_node *const root = &beam_node[0], *const tip = &beam_node[n];
      printf("%-11.6g  %-11.6g  %-11.6g  %-14.6g  %-11.6g  %-11.6g  %-11.6g\n", o->force * tenth / 10,
             (double)tip->position[0], (double)tip->position[1], (double)tip->rotation[2], (double)root->force[0],
             (double)root->force[1], (double)root->moment[2]);
      beam_write_shape(csv, 200);
    }
  }
  return status;
}

/* ---- flutter */

static fb_exact_spectrum spectrum;
static fb_exact_spectrum_work spectrum_work;

/* Slowest motions of the straight column in its plane. */
static fb_status press(const options *o, double force)
{
  fb_status status;
  build(o);
  beam_desc.tip = o->GA > 0 ? FB_HOLD_Z : FB_END_FREE; /* rigid out of the plane without it */
  beam_tip_load(FB_AXES_NODE)->force[0] = (fb_real)-force;
  status = beam_start();
  status = status ? status : beam_settle();
  return status ? status : fb_exact_spectrum_solve(&beam, &spectrum_work, &spectrum, &beam_state, &beam_input, 2);
}

static double growth(void)
{
  return fmax(fabs((double)spectrum.re[0]), fabs((double)spectrum.re[1]));
}

/* The load, in EI/L^2, at which two frequencies meet; 0 where something failed. */
static double flutter_load(const options *o)
{
  const double unit = o->EI / (o->length * o->length);
  double low = 15, high = 25;
  while (high - low > 1e-4) {
    const double middle = (low + high) / 2;
    if (press(o, middle * unit) != FB_OK) {
      return 0;
    }
    if (growth() > 1e-5 * fabs((double)spectrum.im[0])) {
      high = middle;
    } else {
      low = middle;
    }
  }
  return low;
}

static int flutter(const options *o, const char *name)
{
  const double unit = o->EI / (o->length * o->length);
  FILE *const csv = beam_open(name);
  double load;
  if (!csv) {
    return 2;
  }
  fputs("force [EI/L^2],frequency 1 [rad/s],frequency 2 [rad/s],growth [1/s]\n", csv);
  for (int k = 0; k <= 50; k++) {
    if (press(o, 0.5 * k * unit) == FB_OK) {
      fprintf(csv, "%g,%.8g,%.8g,%.6g\n", 0.5 * k, (double)spectrum.im[0], (double)spectrum.im[1], growth());
    }
  }
  if (output_close(csv, name)) {
    return 2;
  }
  load = flutter_load(o);
  if (load <= 0) {
    fprintf(stderr, "follower: no frequencies of the pressed column\n");
    return 1;
  }
  printf("force along the tip, pressing: flutter from %.4f EI/L^2 = %.6g on (slender beams: 20.0510)\n", load,
         load * unit);
  return load > 20.05 * 0.9 && load < 20.05 * 1.005 ? 0 : 1; /* axial and shear strain take a little of it */
}

static void draw(const options *o, const char *flutter_csv)
{
  char svg[512];
  const curve shapes[] = {{o->out, "1:2", "with lines lw 2", "tenths of the force"}};
  const curve modes[] = {{flutter_csv, "1:2", "with lines lw 2", "frequency 1 [rad/s]"},
                         {flutter_csv, "1:3", "with lines lw 2", "frequency 2 [rad/s]"},
                         {flutter_csv, "1:4", "with lines lw 2", "growth [1/s]"}};
  beam_file_name(svg, sizeof svg, o->out, ".svg");
  plot(svg, "set size ratio -1\nset xlabel 'x'\nset ylabel 'y'\n", shapes, 1, stdout);
  beam_file_name(svg, sizeof svg, o->out, "_flutter.svg");
  plot(svg, "set xlabel 'pressing force [EI/L^2]'\n", modes, 3, stdout);
}

int main(int argc, char **argv)
{
  options o = {72, 5e6, 6e7, 6e7 / 2.7, 6 * 0.098 / 386.4, 1000, 40, "follower.csv"};
  char flutter_csv[512];
  int failures = 0;
  fb_status status;
  FILE *csv;
  output_begin(PROGRAM);
  if (read_all(argc, argv, help, read_option, &o) != 0) {
    return 2;
  }
  beam_file_name(flutter_csv, sizeof flutter_csv, o.out, "_flutter.csv");
  csv = beam_open(o.out);
  if (!csv) {
    return 2;
  }
  fputs("x,y,z\n", csv);
  status = bend(&o, csv);
  if (output_close(csv, o.out)) {
    return 2;
  }
  if (status != FB_OK) {
    fprintf(stderr, "follower: %s\n", fb_status_string(status));
    return 1;
  }
  {
    const fb_exact_node *const tip = &beam_node[beam_desc.n_element];
    double exact[3], error;
    exact_tip(exact, &o);
    error = hypot((double)tip->position[0] - exact[0], (double)tip->position[1] - exact[1]) / o.length;
    printf("tip against the differential equation: %.1e of the length\n", error);
    failures += !(error < 1e-4);
  }
  failures += flutter(&o, flutter_csv);
  draw(&o, flutter_csv);
  if (failures) {
    fprintf(stderr, "follower: %d checks failed (more elements?)\n", failures);
  }
  return failures != 0;
}
