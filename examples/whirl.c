/* whirl - a beam clamped to a hub that spins up, [L] 4.10: 72 in of aluminium from rest to 3 Hz within a second.
   The base's rate is prescribed; the beam lags while the hub accelerates, then rings about its steady state, stretched.
   Checks: the steady stretch against its closed form, tan(l L)/l - L with l = rate sqrt(m/EA), to which the mean of
   the last turn has to come; the frequency it rings at (measured) against the spectrum about that steady state; that
   of the beam without stretch and shear, at three rates, against the table of rotating cantilevers.
   Exit: 0 well, 1 a check failed or a step was too long, 2 bad options. */
#define _POSIX_C_SOURCE 200809L /* popen, for gnuplot */
#include "tools/capacities.h"   /* of build/flexbeam: larger models than by default */
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#define PROGRAM "whirl"
#include "common/options.h"
#include "common/output.h"
#include "common/exact_beam.h"
#include "common/plot.h"

typedef struct options {
  double length, EI, EA, GA, mass, hz, ramp, seconds, dt, elements, dissipation;
  const char *out;
} options;

static const char help[] =
    "whirl - spin-up of a beam clamped to a hub, in any consistent units of length and force, seconds\n"
    "usage: whirl [options]\n"
    "  --length L      (72 in)\n"
    "  --ei EI         in the plane of rotation (1.8e8 lb in^2)\n"
    "  --ea EA         (6e7 lb)\n"
    "  --ga GA         0: rigid (2.2222e7 lb)\n"
    "  --mass M        per length (0.001522 lb s^2/in^2)\n"
    "  --hz F          turns per second in the end, 0.01 to 100 (3)\n"
    "  --ramp T        [s] to get there, linearly (1)\n"
    "  --seconds T     in all, more than 1.5 times the ramp (5)\n"
    "  --dt DT         [s] step (5e-4)\n"
    "  --elements N    2 to 400 (10)\n"
    "  --dissipation D 0 to 0.66, of what the step does not resolve (0.05)\n"
    "  --out FILE      CSV: t, rate [rad/s], tip displacement along and across the hub's axes, root force and moment,\n"
    "                  energy (whirl.csv), picture beside it\n"
    "  --help          this text\n";

static int read_option(void *target, const char *name, const char *text)
{
  options *const o = target;
  const number_option numbers[] = {{"--length", &o->length, 1e-9, 1e9},
                                   {"--ei", &o->EI, 1e-30, 1e30},
                                   {"--ea", &o->EA, 1e-30, 1e30},
                                   {"--ga", &o->GA, 0, 1e30},
                                   {"--mass", &o->mass, 1e-30, 1e30},
                                   {"--hz", &o->hz, 0.01, 100},
                                   {"--ramp", &o->ramp, 1e-6, 1e6},
                                   {"--seconds", &o->seconds, 1e-6, 1e6},
                                   {"--dt", &o->dt, 1e-9, 1},
                                   {"--elements", &o->elements, 2, FB_MAX_EXACT},
                                   {"--dissipation", &o->dissipation, 0, 0.66}};
  return strcmp(name, "--out") == 0 ? read_out(&o->out, text) : read_number(numbers, 11, name, text);
}

static void build(const options *o)
{
  const double stiffness[6] = {o->EA, o->GA, o->GA, 0, 0, o->EI};
  const double inertia[6] = {o->mass, o->mass, o->mass, 0, 0, 0};
  beam_uniform(o->length, (int)o->elements, stiffness, inertia);
  beam_desc.dissipation = (fb_real)o->dissipation;
}

typedef struct ringing { /* after the ramp: mean of the displacement, and times at which the lag crosses its mean */
  double sum[2], last, first_time, last_time;
  int count, crossings;
} ringing;

static void listen(ringing *r, double t, double along, double across)
{
  r->sum[0] += along;
  r->sum[1] += across;
  r->count++;
  if (r->count > 1 && r->last < 0 && across >= 0) {
    r->first_time = r->crossings == 0 ? t : r->first_time;
    r->last_time = t;
    r->crossings++;
  }
  r->last = across;
}

static fb_status run(const options *o, ringing *r, double *peak, FILE *csv)
{
  const long steps = lround(o->seconds / o->dt);
  const int n = (int)o->elements;
  fb_status status = FB_OK;
  for (long k = 0; k < steps && status == FB_OK; k++) {
    const double middle = ((double)k + 0.5) * o->dt, t = ((double)k + 1) * o->dt;
    const double rate = 2 * pi * o->hz * (middle < o->ramp ? middle / o->ramp : 1);
    beam_input.w[2] = (fb_real)rate;
    status = beam_advance(o->dt);
    if (status == FB_OK) {
      const double along = (double)beam_node[n].displacement[0], across = (double)beam_node[n].displacement[1];
      fb_energy e;
      (void)fb_exact_energy_eval(&beam, &e, &beam_state);
      fprintf(csv, "%.7g,%.7g,%.9g,%.9g,%.7g,%.7g,%.9g\n", t, rate, along, across, (double)beam_node[0].force[0],
              (double)beam_node[0].moment[2], (double)(e.kinetic + e.strain));
      *peak = fabs(across) > fabs(*peak) ? across : *peak;
      if (t > o->ramp + 0.5 * (o->seconds - o->ramp)) {
        listen(r, t, along, across);
      }
      if (steps > 20 && (k + 1) % (steps / 5) == 0) {
        fprintf(stderr, "whirl: %.0f %%\n", 100.0 * (double)(k + 1) / (double)steps);
      }
    } else {
      fprintf(stderr, "whirl: at %g s: %s\n", t, fb_status_string(status));
    }
  }
  return status;
}

/* Steady state at full rate, and the slowest motion about it. */
static fb_status steady(const options *o, double *stretch, double *omega)
{
  static fb_exact_spectrum spectrum;
  static fb_exact_spectrum_work spectrum_work;
  fb_status status;
  build(o);
  beam_desc.tip = o->GA > 0 ? FB_HOLD_Z : FB_END_FREE; /* rigid out of the plane without it */
  status = beam_start();
  beam_input.w[2] = (fb_real)(2 * pi * o->hz);
  status = status ? status : beam_settle();
  status = status ? status : fb_exact_spectrum_solve(&beam, &spectrum_work, &spectrum, &beam_state, &beam_input, 1);
  *stretch = (double)beam_node[beam_desc.n_element].displacement[0];
  *omega = (double)spectrum.im[0];
  return status;
}

static void draw(const options *o)
{
  char svg[512];
  const curve tip[] = {{o->out, "1:3", "with lines", "tip along the hub"}, {o->out, "1:4", "with lines", "tip across"}};
  beam_file_name(svg, sizeof svg, o->out, ".svg");
  plot(svg, "set ylabel 'displacement'\n", tip, 2, stdout);
}

static int check(const options *o, const ringing *r, double peak)
{
  const double l = 2 * pi * o->hz * sqrt(o->mass / o->EA), exact = tan(l * o->length) / l - o->length;
  const double spun = beam_spun_error(o->length, o->mass, o->EI, (int)o->elements, 0);
  double stretch, omega, measured, mean;
  int failures = 0;
  const fb_status status = steady(o, &stretch, &omega);
  if (status != FB_OK) {
    fprintf(stderr, "whirl: steady state: %s\n", fb_status_string(status));
    return 1;
  }
  mean = r->sum[0] / r->count;
  measured = 2 * pi * (r->crossings - 1) / (r->last_time - r->first_time);
  printf("largest lag of the tip     %.6g\n", peak);
  printf("steady stretch             %.6g, closed form %.6g, mean of the run's second half %.6g\n", stretch, exact,
         mean);
  printf("slowest motion in plane    %.5g Hz about the steady state", omega / (2 * pi));
  if (r->crossings > 2) {
    printf(", %.5g Hz in the run", measured / (2 * pi));
    failures += !(fabs(measured / omega - 1) < 0.02);
  }
  printf("\nlag of a slender beam at three rates: %.1e of the frequency from the table\n", spun);
  failures += !(spun >= 0 && spun < 0.1 / (o->elements * o->elements));
  failures += !(fabs(stretch / exact - 1) < 2.0 / (o->elements * o->elements));
  failures += !(fabs(mean - exact) < 0.05 * exact + peak * peak / o->length); /* what bends is shorter */
  return failures;
}

int main(int argc, char **argv)
{
  options o = {72, 1.8e8, 6e7, 6e7 / 2.7, 6 * 0.098 / 386.4, 3, 1, 5, 5e-4, 10, 0.05, "whirl.csv"};
  ringing r = {{0, 0}, 0, 0, 0, 0, 0};
  double peak = 0;
  int failures;
  FILE *csv;
  output_begin(PROGRAM);
  if (read_all(argc, argv, help, read_option, &o) != 0) {
    return 2;
  }
  if (o.seconds < 1.5 * o.ramp || o.seconds / o.dt > 1e8) {
    return fail("--seconds wants more than 1.5 times the ramp and at most 1e8 steps", "");
  }
  csv = beam_open(o.out);
  if (!csv) {
    return 2;
  }
  fputs("t,rate,along,across,root force,root moment,energy\n", csv);
  build(&o);
  if (beam_start() != FB_OK || run(&o, &r, &peak, csv) != FB_OK) {
    output_drop(csv, o.out);
    return 1;
  }
  if (output_close(csv, o.out)) {
    return 2;
  }
  failures = check(&o, &r, peak);
  draw(&o);
  if (failures) {
    fprintf(stderr, "whirl: %d checks failed (more elements, shorter steps?)\n", failures);
  }
  return failures != 0;
}
