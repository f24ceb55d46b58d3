/* assembly - from parts to a whole: two beams joined to a frame (synthesis), the same frame as one bent line, a column
   that buckles, a component whose tip is a boundary, a damped spinning blade. Each against its closed form or its other
   form. Exit: 0 when all agree. */
#include "tools/capacities.h" /* of build/flexbeam: larger models than by default */
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#include "common/output.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static fb_beam beam[2];
static fb_modes basis[2], joined[2], whole;
static fb_modes_work work;
static fb_join_work join_work;
static fb_shape shape;
static fb_body body;
static fb_body_work body_work;
static fb_analyse_work analyse_work;
static fb_spectrum spectrum;
static int misses;

static void need(fb_status status, const char *what)
{
  if (status != FB_OK) {
    printf("%s: %s\n", what, fb_status_string(status));
    exit(1);
  }
}

static void compare(const char *what, double got, double expected, double tolerance)
{
  const double off = fabs(got / expected - 1.0);
  printf("  %-44s %12.6g %12.6g  %8.1e%s\n", what, got, expected, off, off < tolerance ? "" : "  MISSED");
  misses += !(off < tolerance);
}

/* An aluminium tube, outer radius 30 mm, wall 2 mm. */
static void tube(fb_beam_desc *desc, double length, int elements)
{
  const fb_material aluminium = {FB_R(70e9), FB_R(26.3e9), FB_R(2700.0)};
  const fb_profile outline = {FB_PROFILE_TUBE, FB_R(0.0), {FB_R(0.030), FB_R(0.028)}};
  memset(desc, 0, sizeof *desc);
  desc->length = (fb_real)length;
  desc->n_element = elements;
  desc->n_station = 1;
  need(fb_section_init(&desc->station[0], &aluminium, &outline), "section");
}

/* A mast of 2 m along x, and an arm of 1.5 m at 60 degrees on its end; as two components, then as one bent line. */
static void frame(void)
{
  static fb_beam_desc desc;
  static fb_modes_desc keep;
  const fb_join_desc join = {.n_weld = 1, .weld = {{{0, 1}, {6, 0}}}, .lowest = 6};
  const double c = 0.5, s = sqrt(0.75);
  char what[64];
  int node;
  tube(&desc, 2.0, 6);
  need(fb_beam_init(&beam[0], &desc), "mast");
  keep.lowest = 8;
  keep.n_load = 6; /* residual flexibility where the arm hangs */
  for (int k = 0; k < 6; k++) {
    keep.load[k].node = 6;
    keep.load[k].axis = k;
  }
  need(fb_modes_solve(&basis[0], &work, &beam[0], &keep), "modes of the mast");
  tube(&desc, 1.5, 6);
  desc.root = FB_ROOT_FREE;
  desc.position[0] = FB_R(2.0);
  desc.attitude[0] = FB_R(0.86602540378443865); /* 60 degrees about z */
  desc.attitude[3] = FB_R(0.5);
  need(fb_beam_init(&beam[1], &desc), "arm");
  memset(&keep, 0, sizeof keep);
  keep.basis = FB_BASIS_COMPONENT; /* its root is its boundary */
  keep.lowest = 8;
  keep.n_boundary = 6;
  for (int k = 0; k < 6; k++) {
    keep.boundary[k].axis = k;
  }
  need(fb_modes_solve(&basis[1], &work, &beam[1], &keep), "modes of the arm");
  need(fb_modes_join(joined, &join_work, beam, basis, &join, 2), "joining");
  need(fb_shape_init(&shape, joined->n), "shape");
  need(fb_shape_add_beam(&shape, 0, &beam[0], &joined[0]), "mast");
  need(fb_shape_add_beam_node(&shape, &node, 0, &beam[0], &joined[0], FB_R(2.0)), "weld");
  need(fb_shape_add_beam(&shape, 0, &beam[1], &joined[1]), "arm"); /* goes on from the weld */
  tube(&desc, 0.0, 12);
  desc.n_point = 13;
  for (int k = 0; k <= 12; k++) {
    const double mast = k < 6 ? k / 3.0 : 2.0, arm = k > 6 ? (k - 6) * 0.25 : 0.0;
    desc.point[k][0] = (fb_real)(mast + c * arm);
    desc.point[k][1] = (fb_real)(s * arm);
  }
  memset(&keep, 0, sizeof keep);
  keep.lowest = 6;
  need(fb_beam_init(&beam[0], &desc), "bent line");
  need(fb_modes_solve(&whole, &work, &beam[0], &keep), "modes of the bent line");
  printf("frame of two tubes, joined from 14 modes each; the same as one bent line [Hz]\n");
  for (int k = 0; k < 6; k++) {
    snprintf(what, sizeof what, "frequency %d", k + 1);
    compare(what, (double)joined->omega[k] / 6.283185307179586, (double)whole.omega[k] / 6.283185307179586, 5e-3);
  }
  compare("mass of the joined body [kg]", (double)shape.mass, (double)beam[0].mass, 1e-6);
}

/* Buckling of a clamped column with a pinned tip, 20.19 EI/L^2, and of one under its own weight. */
static void columns(void)
{
  static fb_beam_desc desc;
  static fb_modes_desc keep;
  double EI;
  tube(&desc, 3.0, 8);
  desc.station[0].GA_y = desc.station[0].GA_z = FB_R(0.0); /* Euler's */
  EI = (double)desc.station[0].EI_z;
  need(fb_beam_init(&beam[0], &desc), "column");
  keep.preload.force = -FB_R(1000.0);
  keep.n_boundary = 2; /* held: u_y and u_z of the tip */
  keep.boundary[0].node = keep.boundary[1].node = 8;
  keep.boundary[0].axis = 1;
  keep.boundary[1].axis = 2;
  need(fb_buckling_solve(&whole, &work, &beam[0], &keep), "buckling");
  printf("column\n");
  compare("clamped and pinned, load [N]", 1000.0 * (double)whole.omega[0], 20.190728556 * EI / 9.0, 1e-6);
  keep.preload.force = FB_R(0.0);
  keep.preload.acceleration = -FB_R(9.81);
  keep.n_boundary = keep.boundary[0].node = keep.boundary[0].axis = 0; /* no boundary */
  need(fb_buckling_solve(&whole, &work, &beam[0], &keep), "buckling");
  compare("upright, own weights that it bears", (double)whole.omega[0],
          7.837347 * EI / (9.81 * (double)desc.station[0].mass * 27.0), 1e-5);
}

/* A cantilever that others hold at its tip: static stiffness and frequencies of the reduced component. */
static void component(void)
{
  static fb_beam_desc desc;
  static fb_modes_desc keep;
  static fb_real K[64], M[64], d[8], X[64];
  double EI;
  tube(&desc, 3.0, 8);
  desc.station[0].GA_y = desc.station[0].GA_z = desc.station[0].i_y = desc.station[0].i_z = FB_R(0.0);
  EI = (double)desc.station[0].EI_z;
  need(fb_beam_init(&beam[0], &desc), "component");
  keep.basis = FB_BASIS_COMPONENT;
  keep.count[FB_KIND_BEND_Y] = 2;
  keep.boundary_inertia = 1;
  keep.n_boundary = 2;
  keep.boundary[0].node = keep.boundary[1].node = 8;
  keep.boundary[0].axis = 1;
  keep.boundary[1].axis = 5;
  need(fb_modes_solve(&whole, &work, &beam[0], &keep), "component");
  printf("component with its tip as boundary, %d coordinates\n", whole.n);
  compare("stiffness against a tip displacement [N/m]", (double)whole.K[0], 12.0 * EI / 27.0, 1e-6);
  memcpy(K, whole.K, sizeof(fb_real) * (size_t)(whole.n * whole.n));
  memcpy(M, whole.M, sizeof(fb_real) * (size_t)(whole.n * whole.n));
  need(fb_eig_gen_solve(d, X, K, M, whole.n), "eigenvalues");
  for (int k = 0; k < 2; k++) {
    const double beta = k ? 22.03449156 : 3.516015269, mass = (double)desc.station[0].mass;
    compare("frequency of the free tip [rad/s]", sqrt((double)d[k]), beta * sqrt(EI / (mass * 81.0)), 1e-5);
  }
}

/* A damped blade at a steady spin: flap frequency sqrt(w0^2 + 1.193 w^2) or so (Southwell), damping diluted by it. */
static void blade(void)
{
  static fb_beam_desc desc;
  static fb_modes_desc keep;
  static fb_body_desc level;
  fb_state state;
  fb_input input;
  const double spin = 12.0;
  double rest;
  tube(&desc, 3.0, 8);
  need(fb_beam_init(&beam[0], &desc), "blade");
  keep.count[FB_KIND_BEND_Z] = keep.count[FB_KIND_BEND_Y] = 4;
  need(fb_modes_solve(&whole, &work, &beam[0], &keep), "modes of the blade");
  rest = (double)whole.omega[0];
  level.effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING;
  level.base = FB_BASE_PRESCRIBED;
  for (int k = 0; k < 8; k++) {
    level.zeta[k] = FB_R(0.01);
  }
  need(fb_shape_init(&shape, whole.n), "shape");
  need(fb_shape_add_beam(&shape, 0, &beam[0], &whole), "integrals");
  need(fb_body_init(&body, &body_work, &shape, &level), "body");
  memset(&input, 0, sizeof input);
  input.w[2] = (fb_real)spin;
  need(fb_state_init(&body, &state), "state");
  need(fb_body_trim(&body, &state, &analyse_work, &input), "steady state");
  need(fb_body_spectrum_solve(&body, &analyse_work, &spectrum, &state, &input), "complex modes");
  printf("damped blade at %.0f rad/s; Southwell: lag and flap\n", spin);
  compare("frequency of lag [rad/s]", (double)spectrum.im[0], sqrt(rest * rest + 0.193 * spin * spin), 5e-3);
  compare("frequency of flap [rad/s]", (double)spectrum.im[1], sqrt(rest * rest + 1.193 * spin * spin), 5e-3);
  compare("damping ratio of flap", (double)fb_spectrum_damping(&spectrum, 1),
          0.01 * rest / sqrt(rest * rest + 1.193 * spin * spin), 2e-2);
}

int main(void)
{
  output_begin("assembly");
  printf("%-46s %12s %12s  %8s\n", "", "here", "expected", "off");
  frame();
  columns();
  component();
  blade();
  return misses != 0;
}
