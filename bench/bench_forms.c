/* bench_forms - time of one step of each form of the equations of motion, by scheme and number of elements, CSV on
   stdout. The beam of [DB] 4.3 turned by a constant torque on its hinged root: 1, 2, 3 cubic elements, bending in both
   planes, axial coordinates with nonlinear strain, u_x' free at the root. The forms take turns, so that they share what
   disturbs the machine; the quietest of several runs counts. Equal steps: 0.1 ms with rk4, 0.5 ms with the implicit
   schemes. */
#define _POSIX_C_SOURCE 199309L /* clock_gettime */
#define FB_WITH_FORMS 1
#define FB_MAX_MODES 24
#define FLEXBEAM_IMPLEMENTATION
#include "check.h"
#include <time.h>

#define STEPS 2000
#define RUNS 9
enum { FORMS = 3, SCHEMES = 3 };

static const char *const scheme_name[SCHEMES] = {"rk4", "midpoint", "sdirk"};
static fb_body body[FORMS]; /* by fb_form */

static double now_us(void)
{
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

static void build(int n_element)
{
  static fb_beam_desc beam_desc;
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_shape shape;
  static fb_body_work body_work;
  fb_modes_desc keep;
  fb_body_desc desc;
  memset(&beam_desc, 0, sizeof beam_desc);
  beam_desc.length = 10; /* [m] */
  beam_desc.n_element = n_element;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = FB_R(1.2);                                 /* [kg/m] */
  beam_desc.station[0].EA = FB_R(3.1724e7);                              /* [N] */
  beam_desc.station[0].EI_y = beam_desc.station[0].EI_z = FB_R(14004.0); /* [N m^2] */
  memset(&keep, 0, sizeof keep);
  keep.basis = FB_BASIS_FUNCTIONS;
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = keep.count[FB_KIND_AXIAL] = FB_ALL_MODES;
  keep.root_strain = 1;
  fbb_check(fb_beam_init(&beam, &beam_desc), "beam");
  fbb_check(fb_modes_solve(&modes, &modes_work, &beam, &keep), "functions");
  fbb_check(fb_shape_init(&shape, modes.n), "shape");
  fbb_check(fb_shape_add_beam(&shape, 0, &beam, &modes), "shape integrals");
  fbb_check(fb_shape_add_beam_strain(&shape, 0, &beam, &modes), "strain stations");
  memset(&desc, 0, sizeof desc);
  desc.effects = FB_EFFECTS_STRAIN;
  desc.base = FB_BASE_HINGED;
  for (int form = 0; form < FORMS; form++) {
    desc.form = (fb_form)form;
    fbb_check(fb_body_init(&body[form], &body_work, &shape, &desc), "body");
  }
}

/* Microseconds of a step, all of them from rest. */
static double run(int form, int scheme)
{
  static fb_rk4_work rk4;
  static fb_implicit_work implicit;
  const fb_body *b = &body[form];
  fb_state state;
  fb_input torque;
  double start;
  memset(&torque, 0, sizeof torque);
  torque.n_load = 1;
  torque.load[0].torque[2] = 20; /* [N m] */
  fbb_check(fb_state_init(b, &state), "state");
  start = now_us();
  for (int k = 0; k < STEPS; k++) {
    if (scheme == 0) {
      fbb_check(fb_rk4_step(b, &state, &rk4, &torque, &torque, &torque, FB_R(0.0001)), "rk4");
    } else if (scheme == 1) {
      fbb_check(fb_midpoint_step(b, &state, &implicit, &torque, FB_R(0.0005), 0), "midpoint");
    } else {
      fbb_check(fb_sdirk_step(b, &state, &implicit, &torque, &torque, FB_R(0.0005), 0), "sdirk");
    }
  }
  return (now_us() - start) / STEPS;
}

int main(void)
{
  printf("# flexbeam %s, %s: us per step, the quietest of %d runs of %d steps; ratios to the momentum form\n",
         fb_version_string(), FB_SINGLE ? "single" : "double", RUNS, STEPS);
  printf("scheme,elements,n,momentum,first,second,second/momentum,first/momentum\n");
  for (int scheme = 0; scheme < SCHEMES; scheme++) {
    for (int n_element = 1; n_element <= 3; n_element++) {
      double best[FORMS] = {1e9, 1e9, 1e9};
      build(n_element);
      for (int k = 0; k < RUNS * FORMS; k++) {
        const double us = run(k % FORMS, scheme);
        best[k % FORMS] = us < best[k % FORMS] ? us : best[k % FORMS];
      }
      printf("%s,%d,%d,%.3f,%.3f,%.3f,%.2f,%.2f\n", scheme_name[scheme], n_element, body[0].n, best[FB_FORM_MOMENTUM],
             best[FB_FORM_FIRST], best[FB_FORM_SECOND], best[FB_FORM_SECOND] / best[FB_FORM_MOMENTUM],
             best[FB_FORM_FIRST] / best[FB_FORM_MOMENTUM]);
    }
  }
  return 0;
}
