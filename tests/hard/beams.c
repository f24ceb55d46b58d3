/* beams.c - the exact beam: flutter and buckling at the right load, a beam bent into full circles. */
#include "hard.h"

static fb_exact exact;
static fb_exact_state state;
static fb_exact_work work;
static fb_exact_input input;
static fb_exact_spectrum spectrum;
static fb_exact_spectrum_work spectrum_work;

/* A cantilever of 1 m, 1 kg/m and 1 N m^2 that bends in one plane and does not stretch. */
static void cantilever(int elements)
{
  static fb_exact_desc desc;
  static const fb_section section = {.mass = 1, .EI_z = 1};
  memset(&desc, 0, sizeof desc);
  memset(&input, 0, sizeof input);
  desc.length = 1;
  desc.n_element = elements;
  desc.n_station = 1;
  hard_must(fb_exact_station_init(&desc.station[0], &section), "section");
  hard_must(fb_exact_init(&exact, &desc), "exact beam");
  input.n_load = 1;
  input.load[0].node = elements;
}

static void settle(void)
{
  hard_must(fb_exact_state_init(&exact, &state, &work, NULL), "exact beam");
  hard_must(fb_exact_trim(&exact, &state, &work, &input), "steady state");
}

/* 1: about the straight column under that push at its tip motions grow. */
static int grows(fb_axes axes, double load)
{
  input.load[0].axes = axes;
  input.load[0].force[0] = (fb_real)-load;
  settle();
  hard_must(fb_exact_spectrum_solve(&exact, &spectrum_work, &spectrum, &state, &input, 4), "spectrum");
  for (int k = 0; k < spectrum.n; k++) {
    if ((double)spectrum.re[k] > HARD_TOL(1e-4, 2e-2) * (1.0 + (double)spectrum.im[k])) {
      return 1;
    }
  }
  return 0;
}

/* The load at which the column becomes unstable: the first of coarse steps, then bisection. */
static double critical(fb_axes axes)
{
  double low = 0.0, high = 0.5;
  cantilever(20);
  while (!grows(axes, high) && high < 40.0) {
    low = high;
    high += 0.5;
  }
  for (int k = 0; k < 25; k++) {
    const double middle = 0.5 * (low + high);
    if (grows(axes, middle)) {
      high = middle;
    } else {
      low = middle;
    }
    hard_progress(k, 25);
  }
  return 0.5 * (low + high);
}

/* Euler's load by the modes' stiffness under a push. */
static double buckling(void)
{
  static fb_beam_desc desc;
  static fb_beam beam;
  static fb_modes_desc keep;
  static fb_modes modes;
  static fb_modes_work modes_work;
  memset(&desc, 0, sizeof desc);
  desc.length = 1;
  desc.n_element = 8;
  desc.n_station = 1;
  desc.station[0].mass = desc.station[0].EI_z = 1;
  keep.preload.force = -1;
  hard_must(fb_beam_init(&beam, &desc), "beam");
  hard_must(fb_buckling_solve(&modes, &modes_work, &beam, &keep), "buckling");
  return (double)modes.omega[0];
}

void hard_column(int brief)
{
  const double beck = 20.0509536, euler = 0.25 * HARD_PI * HARD_PI; /* [EI/L^2] */
  double follower, dead;
  hard_row row = {.name = "flutter",
                  .what = "Beck's column under a follower push, by the exact beam's spectrum, 20 elements",
                  .degree = "load EI/L^2",
                  .measure = "load at which it flutters, relative error",
                  .bound = HARD_TOL(2e-4, 2e-3),
                  .naive = "the load taken as dead"};
  (void)brief;
  follower = critical(FB_AXES_NODE);
  dead = critical(FB_AXES_INERTIAL);
  row.hard = beck;
  row.figure = fabs(follower / beck - 1.0);
  row.naive_figure = fabs(dead / beck - 1.0);
  hard_report(&row);
  row.name = "buckling";
  row.what = "Euler's column under a dead push, by the exact beam's spectrum and by fb_buckling_solve";
  row.hard = euler;
  row.measure = "load at which it buckles, relative error";
  row.figure = fmax(fabs(dead / euler - 1.0), fabs(buckling() / euler - 1.0));
  row.naive = "the load turned with the section";
  row.naive_figure = fabs(follower / euler - 1.0);
  hard_report(&row);
}

/* ---- full circles */

void hard_circle(int brief)
{
  static const int turns[] = {1, 5};
  static fb_exact_node node[FB_MAX_EXACT + 1];
  const int elements = 40;
  hard_row row = {.name = "circle",
                  .what = "a cantilever bent into full circles by a moment at its tip, static",
                  .degree = "turns",
                  .measure = "distance of the tip from the root, of the length",
                  .bound = HARD_TOL(1e-9, 1e-4),
                  .naive = "linear beam"};
  (void)brief;
  for (int k = 0; k < HARD_COUNT(turns); k++) {
    const double moment = 2.0 * HARD_PI * turns[k];
    cantilever(elements);
    input.load[0].axes = FB_AXES_NODE;
    input.load[0].torque[2] = (fb_real)moment;
    settle();
    hard_must(fb_exact_nodes_eval(&exact, node, &state), "exact beam");
    row.hard = turns[k];
    row.figure = hard_length(node[elements].position);
    row.naive_figure = hypot(1.0, 0.5 * moment);
    hard_report(&row);
  }
}
