/* bench_forms - time of one step of each form of the equations of motion, by integrator and number of elements, CSV on
   stdout. The beam of [DB] 4.3 turned by a constant torque on its hinged root: 1, 2, 3 cubic elements, bending in both
   planes, axial coordinates with nonlinear strain, u_x' free at the root. The forms take turns, so that they share what
   disturbs the machine; the quietest of several runs counts. Equal steps: 0.1 ms with rk4, 0.5 ms with the implicit
   integrators. */
#define _POSIX_C_SOURCE 200112L /* clock_gettime, uname */
#define FB_WITH_FORMS 1
#define FB_MAX_MODES 24
#define FLEXBEAM_IMPLEMENTATION
#include "report.h"
#include "../examples/common/boom.h"
#include "../examples/common/output.h"

#define STEPS 2000
#define RUNS 9
enum { FORMS = 3, INTEGRATORS = 3 };

static const char *const integrator_name[INTEGRATORS] = {"rk4", "midpoint", "sdirk"};
static fb_form_body body[FORMS]; /* by fb_form */

static void build(int n_element)
{
  static fb_shape shape;
  static fb_body_work body_work;
  const boom b = {BOOM_LENGTH, BOOM_MASS, BOOM_EI, BOOM_EA, .planes = 2, .elements = n_element, .root_strain = 1};
  fb_body_desc desc;
  int tip;
  fbb_check(boom_shape(&shape, &tip, &b), "shape integrals");
  memset(&desc, 0, sizeof desc);
  desc.effects = FB_EFFECTS_STRAIN;
  desc.base = FB_BASE_HINGED;
  for (int form = 0; form < FORMS; form++) {
    const fb_form_desc kind = {(fb_form)form, FB_TORQUE_IDENTITY, NULL};
    fbb_check(fb_form_init(&body[form], &body_work, &shape, &desc, &kind), "body");
  }
}

/* Microseconds of a step, all of them from rest. */
static double run(int form, int integrator)
{
  static fb_form_work work;
  const fb_form_body *b = &body[form];
  const fb_real dt = integrator == FB_INTEGRATOR_RK4 ? FB_R(0.0001) : FB_R(0.0005);
  fb_state state;
  fb_input torque;
  double start;
  memset(&torque, 0, sizeof torque);
  torque.n_load = 1;
  torque.load[0].torque[2] = 20; /* [N m] */
  fbb_check(fb_state_init(&b->body, &state), "state");
  start = clock_ns();
  for (int k = 0; k < STEPS; k++) {
    fbb_check(fb_form_step(b, &state, &work, (fb_integrator)integrator, &torque, &torque, &torque, dt, 0),
              integrator_name[integrator]);
  }
  return 1e-3 * (clock_ns() - start) / STEPS;
}

static void print(const char *name, int n_element, const clock_timing *t)
{
  const clock_timing *momentum = &t[FB_FORM_MOMENTUM], *first = &t[FB_FORM_FIRST], *second = &t[FB_FORM_SECOND];
  printf("%s,%d,%d,%.3f,%.3f,%.3f,%.2f,%.2f,%.3f,%.3f,%.3f\n", name, n_element, body[0].body.n, momentum->lowest,
         first->lowest, second->lowest, second->lowest / momentum->lowest, first->lowest / momentum->lowest,
         momentum->median, first->median, second->median);
}

int main(void)
{
  output_begin("bench_forms");
  (void)fbb_begin();
  printf("# us per step, the quietest and the median of %d runs of %d steps; ratios, of the quietest, to the momentum "
         "form\n",
         RUNS, STEPS);
  printf(
      "integrator,elements,n,momentum,first,second,second/momentum,first/momentum,momentum median,first median,second "
      "median\n");
  for (int integrator = 0; integrator < INTEGRATORS; integrator++) {
    for (int n_element = 1; n_element <= 3; n_element++) {
      static double sample[FORMS][RUNS];
      clock_timing t[FORMS];
      build(n_element);
      for (int k = 0; k < RUNS * FORMS; k++) {
        sample[k % FORMS][k / FORMS] = run(k % FORMS, integrator);
      }
      for (int form = 0; form < FORMS; form++) {
        t[form] = clock_timing_of(sample[form], RUNS);
      }
      print(integrator_name[integrator], n_element, t);
    }
  }
  return 0;
}
