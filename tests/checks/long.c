/* long - a million steps of two systems: a chain of six flexible bodies in free flight driven by its motors, and a
   four-bar with a flexible coupler through its whole turns. Prints what momentum, energy and closure have lost; exits 1
   beyond the bounds: momenta 1e-9 of the largest there was, energy less motor work 1e-6 of the largest kinetic energy,
   closure 1e-10 m. Usage: long STEPS */
#include "../../flexbeam.h"
#include <string.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static fb_beam beam;
static fb_modes modes;
static fb_modes_work modes_work;
static fb_shape shape;
static fb_body body[3];
static fb_body_work body_work;
static fb_system chain, fourbar;
static fb_system_work work;
static fb_system_state state;
static fb_system_input input;

static void must(fb_status status, const char *what)
{
  if (status != FB_OK) {
    printf("%s: %s, joint %d\n", what, fb_status_string(status), work.joint);
    exit(1);
  }
}

static double larger(double a, double b)
{
  return a > b ? a : b;
}

/* A beam along x with a body on its root, node 1 at the tip. */
static void link_init(fb_body *out, double length, double root)
{
  const fb_section section = {.mass = 0.8, .EI_y = 30.0, .EI_z = 20.0, .GJ = 15.0, .i_y = 0.004, .i_z = 0.003};
  const fb_beam_desc desc = {.length = length, .n_element = 6, .n_station = 1, .station = {section}};
  const fb_modes_desc keep = {.count = {2, 1, 0, 1}};
  const fb_body_desc level = {.effects = FB_EFFECTS_FULL, .base = FB_BASE_PRESCRIBED};
  const double center[3] = {0}, inertia[6] = {root, root, root};
  int node;
  must(fb_beam_init(&beam, &desc), "beam");
  must(fb_modes_solve(&modes, &modes_work, &beam, &keep), "modes");
  must(fb_shape_init(&shape, modes.n), "shape");
  must(fb_shape_add_rigid(&shape, 0.5, center, inertia), "root");
  must(fb_shape_add_beam(&shape, 0, &beam, &modes), "shape");
  must(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, length), "node");
  must(fb_body_init(out, &body_work, &shape, &level), "body");
}

static int chain_run(int steps)
{
  static fb_system_desc desc;
  fb_link_motion start[6];
  fb_momentum first, now;
  fb_energy energy;
  double before, lost = 0.0, linear = 0.0, angular = 0.0, kinetic = 0.0, most_p = 0.0, most_h = 0.0;
  memset(start, 0, sizeof start);
  desc.n_body = 6;
  for (int k = 0; k < 6; k++) {
    desc.joint[k].kind = k == 0 ? FB_JOINT_FREE : k % 2 ? FB_JOINT_REVOLUTE : FB_JOINT_UNIVERSAL;
    desc.joint[k].parent = k - 1;
    desc.joint[k].parent_node = 1;
    desc.joint[k].stiffness[0] = desc.joint[k].stiffness[1] = k > 0 ? 2.0 : 0.0;
    start[k].value[0] = k > 0 ? 0.3 : 0.0;
    start[k].speed[0] = 0.1;
  }
  start[0].speed[4] = 0.2;
  must(fb_system_init(&chain, &work, body, &desc, 1), "chain");
  must(fb_system_state_init(&chain, body, &state, &work, start, NULL), "chain");
  must(fb_system_momentum_eval(&chain, body, &work, &first, &state, NULL), "momentum");
  must(fb_system_energy_eval(&chain, body, &work, &energy, &state, NULL), "energy");
  before = energy.kinetic + energy.strain;
  for (int step = 1; step <= steps; step++) {
    for (int k = 1; k < 6; k++) {
      input.drive[k].torque[0] = 0.02 * sin(0.002 * step * k);
    }
    must(fb_system_rk4_step(&chain, body, &state, &work, &input, &input, &input, 2.5e-4), "step");
    if (step % 1000 == 0) {
      must(fb_system_momentum_eval(&chain, body, &work, &now, &state, NULL), "momentum");
      must(fb_system_energy_eval(&chain, body, &work, &energy, &state, NULL), "energy");
      for (int i = 0; i < 3; i++) {
        linear = larger(linear, fabs((double)(now.linear[i] - first.linear[i])));
        angular = larger(angular, fabs((double)(now.angular[i] - first.angular[i])));
        most_p = larger(most_p, fabs((double)now.linear[i]));
        most_h = larger(most_h, fabs((double)now.angular[i]));
      }
      kinetic = larger(kinetic, energy.kinetic);
      lost = larger(lost, fabs((double)(energy.kinetic + energy.strain - before - state.motor_work)));
    }
  }
  printf("chain of six, %d steps: momentum %.1e of %.2g N s, angular momentum %.1e of %.2g N m s, energy less work "
         "%.1e of %.2g J\n",
         steps, linear, most_p, angular, most_h, lost, kinetic);
  return linear < 1e-9 * most_p && angular < 1e-9 * most_h && lost < 1e-6 * kinetic;
}

static int fourbar_run(int steps)
{
  static fb_system_desc desc;
  static fb_system_motion motion;
  fb_link_motion start[3];
  double closure = 0.0, late = 0.0;
  memset(start, 0, sizeof start);
  memset(&input, 0, sizeof input);
  link_init(&body[0], 0.4, 0.02); /* crank, coupler, rocker */
  link_init(&body[1], 1.0, 0.02);
  link_init(&body[2], 0.8, 0.02);
  desc.n_body = 3;
  for (int k = 0; k < 3; k++) {
    desc.model[k] = k;
    desc.joint[k].kind = FB_JOINT_REVOLUTE;
    desc.joint[k].parent = k == 1 ? 0 : FB_GROUND;
    desc.joint[k].parent_node = k == 1;
  }
  desc.joint[2].position[0] = 1.1;
  desc.n_loop = 1;
  desc.loop[0].kind = FB_JOINT_REVOLUTE;
  desc.loop[0].parent = 1;
  desc.loop[0].parent_node = 1;
  desc.loop[0].child = 2;
  desc.loop[0].child_node = 1;
  start[0].value[0] = 0.7;
  start[1].value[0] = 0.2;
  start[2].value[0] = 1.6;
  start[0].speed[0] = 2.0;
  must(fb_system_init(&fourbar, &work, body, &desc, 3), "four-bar");
  must(fb_system_state_init(&fourbar, body, &state, &work, start, NULL), "four-bar");
  for (int step = 1; step <= steps; step++) {
    must(fb_system_rk4_step(&fourbar, body, &state, &work, NULL, NULL, NULL, 2e-4), "step");
    if (step % 500 == 0) {
      fb_node_motion a, b;
      double gap = 0.0;
      must(fb_system_motion_eval(&fourbar, body, &work, &motion, &state, NULL), "motion");
      must(fb_body_node_motion_eval(&body[1], &a, &motion.pose[1], &motion.motion[1], 1), "node");
      must(fb_body_node_motion_eval(&body[2], &b, &motion.pose[2], &motion.motion[2], 1), "node");
      for (int i = 0; i < 3; i++) {
        gap = larger(gap, fabs((double)(a.position[i] - b.position[i])));
      }
      closure = larger(closure, gap);
      late = step > steps / 2 ? larger(late, gap) : late;
    }
  }
  printf("four-bar of flexible rods, %d steps: closure %.1e m, in the second half %.1e m\n", steps, closure, late);
  return closure < 1e-10;
}

int main(int argc, char **argv)
{
  const int steps = argc > 1 ? atoi(argv[1]) : 1000000;
  int well;
  link_init(&body[0], 1.0, 0.02);
  well = chain_run(steps);
  return fourbar_run(steps) && well ? 0 : 1;
}
