/* flap - a flapping wing, [L] 4.11: a beam clamped to a base that swings 30 degrees up and down, once a second.
   Two wings: aluminium, which follows, and one a thousand times softer, which bends far and rings at its own 7 Hz.
   Checks: the first frequency of each wing against 3.516 sqrt(EI/mL^4); that of a slender wing on a base that turns, at
   three rates, against the table of rotating cantilevers; the soft wing's tip against a run with half the step and
   twice the elements.
   Exit: 0 well, 1 a check failed or a step was too long, 2 bad options. */
#define _POSIX_C_SOURCE 200809L /* popen, for gnuplot */
#include "tools/capacities.h"   /* of build/flexbeam: larger models than by default */
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#define PROGRAM "flap"
#include "common/options.h"
#include "common/output.h"
#include "common/exact_beam.h"
#include "common/plot.h"

typedef struct options {
  double length, width, height, E, soft, density, nu, amplitude, hz, seconds, dt, elements, dissipation;
  const char *out;
} options;

static const char help[] =
    "flap - a flapping wing, stiff and soft, in any consistent units of length and force, seconds\n"
    "usage: flap [options]\n"
    "  --length L      (12 in)\n"
    "  --width B       of the rectangular section (2 in)\n"
    "  --height H      in the direction of flapping (1 in)\n"
    "  --modulus E     Young's, of the stiff wing (1e7 psi)\n"
    "  --soft E        of the soft wing (1e4 psi)\n"
    "  --poisson NU    (0.35)\n"
    "  --density R     mass per volume (2.5362e-4 lb s^2/in^4)\n"
    "  --amplitude A   [degrees] of the base, 0 to 90 (30)\n"
    "  --hz F          beats per second (1)\n"
    "  --seconds T     (2)\n"
    "  --dt DT         [s] step (2e-4)\n"
    "  --elements N    2 to 100 (10)\n"
    "  --dissipation D 0 to 0.66, of what the step does not resolve (0.05)\n"
    "  --out FILE      CSV: t, height of the tip of base, stiff and soft wing (flap.csv), picture beside it; "
    "_shapes.csv:\n"
    "                  the soft wing in space by tenths of a beat\n"
    "  --help          this text\n";

static int read_option(void *target, const char *name, const char *text)
{
  options *const o = target;
  const number_option numbers[] = {{"--length", &o->length, 1e-9, 1e9},
                                   {"--width", &o->width, 1e-9, 1e9},
                                   {"--height", &o->height, 1e-9, 1e9},
                                   {"--modulus", &o->E, 1e-9, 1e30},
                                   {"--soft", &o->soft, 1e-9, 1e30},
                                   {"--poisson", &o->nu, 0, 0.5},
                                   {"--density", &o->density, 1e-30, 1e9},
                                   {"--amplitude", &o->amplitude, 0, 90},
                                   {"--hz", &o->hz, 1e-6, 1e6},
                                   {"--seconds", &o->seconds, 1e-6, 1e6},
                                   {"--dt", &o->dt, 1e-9, 1},
                                   {"--elements", &o->elements, 2, 100},
                                   {"--dissipation", &o->dissipation, 0, 0.66}};
  return strcmp(name, "--out") == 0 ? read_out(&o->out, text) : read_number(numbers, 13, name, text);
}

static fb_status build(const options *o, double E, int elements)
{
  const double A = o->width * o->height, flap = A * o->height * o->height / 12, lag = A * o->width * o->width / 12;
  const double G = E / (2 * (1 + o->nu)), m = o->density * A;
  const double stiffness[6] = {E * A, G * A, G * A, G * (flap + lag), E * flap, E * lag};
  const double inertia[6] = {m, m, m, o->density * (flap + lag), o->density * flap, o->density * lag};
  beam_uniform(o->length, elements, stiffness, inertia);
  beam_desc.dissipation = (fb_real)o->dissipation;
  return beam_start();
}

/* The base turns about y by -angle: a positive angle lifts the tip. */
static double angle_of(const options *o, double t)
{
  return o->amplitude * pi / 180 * sin(2 * pi * o->hz * t);
}

/* Heights of the tip by step; shapes: NULL or where to write ten of them for each beat. */
static fb_status run(const options *o, double E, int elements, double dt, double *height, long steps, FILE *shapes)
{
  const double beat = 1 / o->hz;
  long drawn = 0;
  fb_status status = build(o, E, elements);
  for (long k = 0; k < steps && status == FB_OK; k++) {
    const double t = (double)k * dt; /* mean rate of the step: the base is where it should be after it */
    beam_input.w[1] = (fb_real)(-(angle_of(o, t + dt) - angle_of(o, t)) / dt);
    status = beam_advance(dt);
    height[k] = (double)beam_node[elements].position[2];
    if (shapes && t + dt >= (double)drawn * beat / 10 && t + dt > o->seconds - 1.05 * beat) {
      beam_write_shape(shapes, 100);
    }
    drawn = (long)floor((t + dt) / beat * 10) + 1;
  }
  if (status != FB_OK) {
    fprintf(stderr, "flap: E = %g: %s\n", E, fb_status_string(status));
  }
  return status;
}

/* First frequency of the wing at rest, of its closed form. */
static double frequency_ratio(const options *o, double E, double *hz)
{
  static fb_exact_spectrum spectrum;
  static fb_exact_spectrum_work work;
  const double euler = 3.5160152685 * o->height * sqrt(E / (12 * o->density)) / (o->length * o->length);
  fb_status status = build(o, E, (int)o->elements);
  beam_desc.tip = FB_HOLD_Y;
  status = status ? status : beam_start();
  status = status ? status : fb_exact_spectrum_solve(&beam, &work, &spectrum, &beam_state, NULL, 1);
  *hz = status == FB_OK ? (double)spectrum.im[0] / (2 * pi) : 0;
  return *hz * 2 * pi / euler;
}

static void draw(const options *o, const char *shapes)
{
  char svg[512];
  const curve tips[] = {{o->out, "1:2", "with lines", "base"},
                        {o->out, "1:3", "with lines", "stiff wing"},
                        {o->out, "1:4", "with lines lw 2", "soft wing"}};
  const curve lines[] = {{shapes, "1:3", "with lines", "soft wing by tenths of a beat"}};
  beam_file_name(svg, sizeof svg, o->out, ".svg");
  plot(svg, "set ylabel 'height of the tip'\n", tips, 3, stdout);
  beam_file_name(svg, sizeof svg, o->out, "_shapes.svg");
  plot(svg, "set size ratio -1\nset xlabel 'x'\nset ylabel 'z'\n", lines, 1, stdout);
}

static double largest(const double *x, long n)
{
  double most = 0;
  for (long k = 0; k < n; k++) {
    most = fmax(most, fabs(x[k]));
  }
  return most;
}

/* Runs both wings and the fine one, writes and tells; failures, or -1 where a run stopped. */
static int compare(const options *o, long steps, double *stiff, double *soft, double *fine, FILE *csv, FILE *shapes)
{
  const double A = o->width * o->height, EI = o->soft * A * o->height * o->height / 12;
  double hz[2], ratio[2], spun, difference = 0;
  int failures = 0;
  fprintf(stderr, "flap: three runs of %ld, %ld and %ld steps\n", steps, steps, 2 * steps);
  if (run(o, o->E, (int)o->elements, o->dt, stiff, steps, NULL) != FB_OK ||
      run(o, o->soft, (int)o->elements, o->dt, soft, steps, shapes) != FB_OK ||
      run(o, o->soft, 2 * (int)o->elements, o->dt / 2, fine, 2 * steps, NULL) != FB_OK) {
    return -1;
  }
  fputs("t,base,stiff,soft\n", csv);
  for (long k = 0; k < steps; k++) {
    const double t = ((double)k + 1) * o->dt;
    fprintf(csv, "%.7g,%.9g,%.9g,%.9g\n", t, o->length * sin(angle_of(o, t)), stiff[k], soft[k]);
    difference = fmax(difference, fabs(soft[k] - fine[2 * k + 1]));
  }
  ratio[0] = frequency_ratio(o, o->E, &hz[0]);
  ratio[1] = frequency_ratio(o, o->soft, &hz[1]);
  printf("first frequencies      %.4g Hz, %.4g Hz (%.4f, %.4f of a slender beam's)\n", hz[0], hz[1], ratio[0],
         ratio[1]);
  spun = beam_spun_error(o->length, o->density * A, EI, (int)o->elements, 1);
  printf("flapping of a slender wing that turns, at three rates: %.1e of the frequency from the table\n", spun);
  failures += !(spun >= 0 && spun < 0.1 / (o->elements * o->elements));
  printf("largest tip height     base %.5g, stiff wing %.5g, soft wing %.5g\n",
         o->length * sin(o->amplitude * pi / 180), largest(stiff, steps), largest(soft, steps));
  printf("soft wing against half the step, twice the elements: %.1e of the length\n", difference / o->length);
  failures += !(difference < 0.02 * o->length);
  for (int k = 0; k < 2; k++) { /* shear and rotary inertia lower it */
    const double slender = 3 * (1 + o->nu) * o->height * o->height / (o->length * o->length) + 0.005;
    failures += !(ratio[k] < 1.005 && ratio[k] > 1 - slender);
  }
  return failures;
}

int main(int argc, char **argv)
{
  options o = {12, 2, 1, 1e7, 1e4, 0.098 / 386.4, 0.35, 30, 1, 2, 2e-4, 10, 0.05, "flap.csv"};
  char shapes_name[512];
  double *heights;
  long steps;
  int failures;
  FILE *csv, *shapes;
  output_begin(PROGRAM);
  if (read_all(argc, argv, help, read_option, &o) != 0) {
    return 2;
  }
  steps = lround(o.seconds / o.dt);
  if (steps < 1 || steps > 10000000) {
    return fail("--seconds and --dt want 1 to 1e7 steps", "");
  }
  beam_file_name(shapes_name, sizeof shapes_name, o.out, "_shapes.csv");
  csv = beam_open(o.out);
  shapes = csv ? beam_open(shapes_name) : NULL;
  if (!shapes) {
    return 2;
  }
  heights = malloc(sizeof *heights * 4 * (size_t)steps);
  if (!heights) {
    return fail("no memory for so many steps", "");
  }
  fputs("x,y,z\n", shapes);
  failures = compare(&o, steps, heights, heights + steps, heights + 2 * steps, csv, shapes);
  free(heights);
  if (output_close(csv, o.out) | output_close(shapes, shapes_name)) {
    return 2;
  }
  if (failures >= 0) {
    draw(&o, shapes_name);
  }
  if (failures > 0) {
    fprintf(stderr, "flap: %d checks failed (more elements, shorter steps?)\n", failures);
  }
  return failures != 0;
}
