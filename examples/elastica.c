/* elastica - a cantilever bent as far as one likes: a tip moment rolls it into a circle, a tip force (dead, or turning
   with the tip) bends it over.
   The load grows in ten parts, of which the shapes are drawn. Checks: the circle, where only a moment acts; and what is
   constant along any such beam, M^2/2EI + N^2/2EA + Q^2/2GA + N of the internal loads, whatever its shape.
   Exit: 0 well, 1 a check failed or there is no such state, 2 bad options. */
#define _POSIX_C_SOURCE 200809L /* popen, for gnuplot */
#include "tools/capacities.h"   /* of build/flexbeam: larger models than by default */
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#define PROGRAM "elastica"
#include "common/options.h"
#include "common/output.h"
#include "common/exact_beam.h"
#include "common/plot.h"

typedef struct options {
  double length, EI, EA, GA, moment, force, follower, elements;
  const char *out;
} options;

static const char help[] = "elastica - a cantilever under a tip moment or force of any size, in any consistent units\n"
                           "usage: elastica [options]\n"
                           "  --length L     (1)\n"
                           "  --ei EI        bending stiffness (1)\n"
                           "  --ea EA        axial stiffness, 0: rigid (0)\n"
                           "  --ga GA        shear stiffness, 0: rigid (0)\n"
                           "  --moment M     at the tip (2 pi EI/L, a full circle; 0 where a force is given)\n"
                           "  --force F      at the tip, across the undeformed beam (0)\n"
                           "  --follower 1   the force turns with the tip (0)\n"
                           "  --elements N   1 to 400 (40)\n"
                           "  --out FILE     CSV of the shapes: x, y, z, a block for each tenth of the load "
                           "(elastica.csv), picture beside it\n"
                           "  --help         this text\n";

static int read_option(void *target, const char *name, const char *text)
{
  options *const o = target;
  const number_option numbers[] = {{"--length", &o->length, 1e-9, 1e9},
                                   {"--ei", &o->EI, 1e-30, 1e30},
                                   {"--ea", &o->EA, 0, 1e30},
                                   {"--ga", &o->GA, 0, 1e30},
                                   {"--moment", &o->moment, -1e30, 1e30},
                                   {"--force", &o->force, -1e30, 1e30},
                                   {"--follower", &o->follower, 0, 1},
                                   {"--elements", &o->elements, 1, FB_MAX_EXACT}};
  return strcmp(name, "--out") == 0 ? read_out(&o->out, text) : read_number(numbers, 8, name, text);
}

/* What of M^2/2EI + N^2/2EA + Q^2/2GA + N changes along the beam, of the largest of its terms; bound: what that is at
   most, of order 4 in the turn from node to node, of order 2 where the strain is large. */
static double first_integral_error(const options *o, double *bound)
{
  double low = 0, high = 0, scale = 0, turn = 0, strain = 0;
  for (int k = 0; k <= beam_desc.n_element; k++) {
    const double M = (double)beam_node[k].moment[2], N = (double)beam_node[k].force[0],
                 Q = (double)beam_node[k].force[1], bend = M * M / (2 * o->EI);
    const double sum = bend + N + (o->EA > 0 ? N * N / (2 * o->EA) : 0) + (o->GA > 0 ? Q * Q / (2 * o->GA) : 0);
    low = k == 0 || sum < low ? sum : low;
    high = k == 0 || sum > high ? sum : high;
    scale = fmax(scale, fmax(bend, fmax(fabs(N), fabs(Q))));
    turn = fmax(turn, fabs(M) / o->EI * o->length / beam_desc.n_element);
    strain = fmax(strain, fmax(o->EA > 0 ? fabs(N) / o->EA : 0, o->GA > 0 ? fabs(Q) / o->GA : 0));
  }
  *bound = 0.1 * pow(turn, 4) + 2 * strain * turn * turn + 1e-9;
  return scale > 0 ? (high - low) / scale : 0;
}

/* Distance of the tip from that of the arc. */
static double circle_error(const options *o)
{
  const double angle = o->moment * o->length / o->EI, r = o->EI / o->moment;
  const fb_real *const p = beam_node[beam_desc.n_element].position;
  return hypot((double)p[0] - r * sin(angle), (double)p[1] - r * (1 - cos(angle))) / o->length;
}

static void draw(const options *o)
{
  char svg[512];
  const curve shapes[] = {{o->out, "1:2", "with lines lw 2", "tenths of the load"}};
  beam_file_name(svg, sizeof svg, o->out, ".svg");
  plot(svg, "set size ratio -1\nset xlabel 'x'\nset ylabel 'y'\n", shapes, 1, stdout);
}

int main(int argc, char **argv)
{
  options o = {1, 1, 0, 0, (double)NAN, 0, 0, 40, "elastica.csv"};
  int n, failures = 0;
  fb_status status = FB_OK;
  FILE *csv;
  output_begin(PROGRAM);
  if (read_all(argc, argv, help, read_option, &o) != 0) {
    return 2;
  }
  o.moment = isnan(o.moment) ? (fabs(o.force) > 0 ? 0 : 2 * pi * o.EI / o.length) : o.moment;
  n = (int)o.elements;
  {
    const double stiffness[6] = {o.EA, o.GA, o.GA, 0, 0, o.EI}, none[6] = {0};
    beam_uniform(o.length, n, stiffness, none);
  }
  csv = beam_open(o.out);
  if (!csv) {
    return 2;
  }
  fputs("x,y,z\n", csv);
  status = beam_start();
  printf("load     tip x        tip y        rotation [rad]  iterations\n");
  for (int tenth = 1; tenth <= 10 && status == FB_OK; tenth++) {
    fb_load *load;
    beam_input.n_load = 0;
    load = beam_tip_load(o.follower > 0 ? FB_AXES_NODE : FB_AXES_INERTIAL);
    load->force[1] = (fb_real)(o.force * tenth / 10);
    load->torque[2] = (fb_real)(o.moment * tenth / 10);
    status = beam_settle();
    if (status == FB_OK) {
      printf("%3d %%  %11.6g  %11.6g  %14.6g  %10d\n", 10 * tenth, (double)beam_node[n].position[0],
             (double)beam_node[n].position[1], (double)beam_node[n].rotation[2], beam_work.iterations);
      beam_write_shape(csv, 200);
    }
  }
  if (output_close(csv, o.out)) {
    return 2;
  }
  if (status != FB_OK) {
    fprintf(stderr, "elastica: %s\n", fb_status_string(status));
    return 1;
  }
  {
    double bound;
    const double along = first_integral_error(&o, &bound);
    printf("constant along the beam to %.1e (bound %.1e)\n", along, bound);
    failures += !(along <= bound);
    if (fabs(o.force) <= 0 && fabs(o.moment) > 0) {
      printf("tip against the circle's: %.1e of the length\n", circle_error(&o));
      failures += !(circle_error(&o) < 1e-9);
    }
  }
  draw(&o);
  if (failures) {
    fprintf(stderr, "elastica: %d checks failed (more elements?)\n", failures);
  }
  return failures != 0;
}
