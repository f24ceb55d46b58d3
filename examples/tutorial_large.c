/* tutorial_large - a boom of a solar sail, clamped at its root, is pulled aside at its tip by 44 % of its length and let go:
   by a modal body with the quadratic displacement field (FB_EFFECTS_FULL), by the same modes as modes of curvature
   (FB_EFFECTS_LARGE), and by the geometrically exact beam, which is the judge. It prints where the tip is, the largest
   error by the largest deflection, and the time that a second takes.
   Check: large deflection is within 0.1 %, the quadratic field is not. Exit: 0 well, 1 a check failed. */
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#include <math.h>
#include <stdio.h>
#include <time.h>

enum { ROWS = 80, STEPS = 8, EXACT_STEPS = 32, ELEMENTS = 32 }; /* of the exact beam: steps and elements */

static const double row = 0.1; /* [s] between rows; a row has STEPS steps */
static const fb_section tube = {.mass = FB_R(0.2), .EI_y = 120, .EI_z = 120}; /* [kg/m], [N m^2] */
static const fb_real length = 6;                                              /* [m] */
static fb_body body;
static fb_build_work build_work;
static fb_exact exact;
static fb_exact_work exact_work;
static fb_exact_state exact_state;
static double judge[ROWS + 1][3], tip[ROWS + 1][3];
static clock_t begin; /* of the run */

/* The force [N] on the tip along z: up and down within 4 s, then none. */
static fb_load pull(double t, int node)
{
  fb_load load = {.node = node, .axes = FB_AXES_BODY};
  load.force[2] = t < 4.0 ? (fb_real)(1.75 * (1 - cos(1.5707963267949 * t))) : 0;
  return load;
}

static fb_status run_exact(void)
{
  static fb_exact_desc desc = {.length = 6, .n_element = ELEMENTS, .n_station = 1};
  static fb_exact_node node[ELEMENTS + 1];
  static fb_exact_input input = {.n_load = 1};
  const double dt = row / EXACT_STEPS;
  fb_status status = fb_exact_station_init(&desc.station[0], &tube);
  status = status ? status : fb_exact_init(&exact, &desc);
  input.load[0] = pull(0, ELEMENTS);
  status = status ? status : fb_exact_state_init(&exact, &exact_state, &exact_work, &input);
  begin = clock();
  for (int k = 0; k <= ROWS && status == FB_OK; k++) {
    status = fb_exact_nodes_eval(&exact, node, &exact_state);
    for (int i = 0; i < 3; i++) {
      judge[k][i] = (double)node[ELEMENTS].position[i];
    }
    for (int s = 0; s < EXACT_STEPS && k < ROWS && status == FB_OK; s++) { /* loads in the middle of each step */
      input.load[0] = pull(row * k + dt * (s + 0.5), ELEMENTS);
      status = fb_exact_step(&exact, &exact_state, &exact_work, &input, (fb_real)dt);
    }
  }
  return status;
}

static fb_status run_body(unsigned effects)
{
  const fb_beam_desc boom = {.length = length, .n_element = 10, .n_station = 1, .station = {tube}};
  const fb_modes_desc keep = {.count = {0, 4}};                  /* bending along z */
  const fb_real limit = effects == FB_EFFECTS_FULL ? length : 0; /* beyond what the quadratic field is good for */
  const fb_build_desc craft = {.n_part = 1,
                               .part = {{.n_node = 1, .node = {length}}},
                               .body = {.effects = effects, .base = FB_BASE_PRESCRIBED, .deflection_limit = limit}};
  const double dt = row / STEPS;
  fb_state state;
  static fb_rk4_work work;
  fb_motion motion;
  fb_node_motion node;
  fb_input at[3] = {{.n_load = 1}, {.n_load = 1}, {.n_load = 1}}; /* begin, middle and end of a step */
  fb_status status = fb_body_build(&body, &build_work, &craft, &boom, &keep, 1);
  status = status ? status : fb_state_init(&body, &state);
  begin = clock();
  for (int k = 0; k <= ROWS && status == FB_OK; k++) {
    at[0].load[0] = pull(row * k, 1);
    status = fb_body_motion_eval(&body, &motion, &state, &at[0]);
    status = status ? status : fb_body_node_motion_eval(&body, &node, &state, &motion, 1);
    for (int i = 0; i < 3; i++) {
      tip[k][i] = (double)node.displacement[i] + (i == 0 ? (double)length : 0.0);
    }
    for (int s = 0; s < STEPS && k < ROWS && status == FB_OK; s++) {
      for (int i = 0; i < 3; i++) {
        at[i].load[0] = pull(row * k + dt * (s + 0.5 * i), 1);
      }
      status = fb_rk4_step(&body, &state, &work, &at[0], &at[1], &at[2], (fb_real)dt);
    }
  }
  return status;
}

/* One line of the table; returns the error. */
static double report(const char *name, double x[][3])
{
  double most = 0, error = 0;
  for (int k = 0; k <= ROWS; k++) {
    most = fmax(most, hypot(judge[k][0] - (double)length, judge[k][2]));
    error = fmax(error, hypot(x[k][0] - judge[k][0], x[k][2] - judge[k][2]));
  }
  printf("%-18s %8.4f %8.4f   %8.4f %8.4f  %9.4f %%  %10.4f\n", name, x[20][0], x[20][2], x[ROWS][0], x[ROWS][2],
         100 * error / most, 1e3 * (double)(clock() - begin) / CLOCKS_PER_SEC / (row * ROWS));
  return error / most;
}

int main(void)
{
  static const unsigned effects[2] = {FB_EFFECTS_FULL, FB_EFFECTS_LARGE};
  double error[2] = {0, 0};
  fb_status status = run_exact();
  printf("tip [m]             x(2 s)   z(2 s)     x(8 s)   z(8 s)        error   ms for 1 s\n");
  (void)report("exact beam", judge);
  for (int k = 0; k < 2 && status == FB_OK; k++) {
    status = run_body(effects[k]);
    error[k] = report(k ? "FB_EFFECTS_LARGE" : "FB_EFFECTS_FULL", tip);
  }
  if (status != FB_OK || !(error[1] < 1e-3) || !(error[0] > 1e-2)) {
    printf("failed: %s\n", fb_status_string(status));
    return 1;
  }
  return fflush(stdout) == 0 ? 0 : 1;
}
