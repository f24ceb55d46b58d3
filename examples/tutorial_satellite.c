/* tutorial_satellite - a satellite with two flexible booms on hinges is turned by 30 degrees by three reaction wheels.
   It shows: wheels inside a body, a body with a beam in one call, bodies on joints, a controller that runs between the
   steps. Check: the pointing error at the end, and the angular momentum, which stays zero. Exit: 0 well, 1 a check
   failed. */
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#include <math.h>
#include <stdio.h>

enum { HUB, BOOM }; /* models; body 0 is the hub, bodies 1 and 2 are the booms */

static fb_body model[2];
static fb_build_work build_work;
static fb_system craft;
static fb_system_work work;
static fb_system_state state;
static fb_system_input input;
static fb_system_motion motion;

/* A rigid hub with a wheel about each of its axes. Wheels inside a body need no joints, and their spin costs no step. */
static fb_status make_hub(void)
{
  const fb_real inertia = FB_R(0.05); // [kg m^2] of a wheel about its axis
  fb_build_desc hub = {.mass = 300, .inertia = {60, 60, 80}, .body = {.effects = FB_EFFECTS_RIGID}};
  hub.body.n_rotor = 3;
  for (int i = 0; i < 3; i++) {
    hub.body.rotor[i].axis[i] = 1;
    hub.body.rotor[i].inertia = inertia;
  }
  return fb_body_build(&model[HUB], &build_work, &hub, NULL, NULL, 0);
}

/* A boom along its own x axis, with the fitting that is on the hinge. */
static fb_status make_boom(void)
{
  const fb_section tube = {.mass = FB_R(0.5), .EI_y = 400, .EI_z = 400}; // [kg/m], [N m^2]
  const fb_beam_desc beam = {.length = 5, .n_element = 8, .n_station = 1, .station = {tube}};
  const fb_modes_desc keep = {.count = {2, 2}}; // bending modes along y, along z
  const fb_build_desc boom = {.mass = 1,        // [kg]
                              .inertia = {FB_R(0.01), FB_R(0.01), FB_R(0.01)},
                              .n_part = 1,
                              .part = {{.n_node = 1, .node = {5}}}, // node 1: its tip
                              .zeta = FB_R(0.005),
                              .body = {.effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING}};
  return fb_body_build(&model[BOOM], &build_work, &boom, &beam, &keep, 1);
}

/* The booms lie along x and -x of the hub, each on a hinge about z with a spring and a damper. */
static fb_status make_craft(void)
{
  fb_system_desc desc = {.n_body = 3, .model = {HUB, BOOM, BOOM}, .joint = {{.kind = FB_JOINT_FREE}}};
  desc.joint[0].parent = FB_GROUND;
  for (int side = 0; side < 2; side++) {
    fb_joint_desc *const joint = &desc.joint[1 + side]; // its parent is body 0 where nothing else is said
    joint->kind = FB_JOINT_REVOLUTE;                    // about z of the joint, which is that of both bodies
    joint->position[0] = side ? -FB_R(0.5) : FB_R(0.5);
    joint->attitude[side ? 3 : 0] = 1; // half a turn about z for the second
    joint->stiffness[0] = 1000;        // [N m/rad]
    joint->damping[0] = 10;            // [N m s/rad]
  }
  return fb_system_init(&craft, &work, model, &desc, 2);
}

/* Torques of the wheels from attitude and rate of the hub: proportional and differential. Returns the error [rad]. */
static double control(const fb_real wanted[4])
{
  const fb_real *q = state.link[0].quat, back[4] = {wanted[0], -wanted[1], -wanted[2], -wanted[3]};
  fb_real off[4], error[3];
  fb_quat_mul(off, back, q);
  fb_quat_to_rotvec(error, off);
  for (int i = 0; i < 3; i++) { // what a motor does to its wheel it does to the hub, in the other direction
    input.rotor[0][i].torque = 5 * error[i] + 40 * motion.motion[0].w[i]; // [N m]
  }
  return sqrt((double)fb_vec3_dot(error, error));
}

int main(void)
{
  const fb_real turn[3] = {FB_R(0.3), FB_R(0.2), FB_R(0.38)}; // [rad] rotation vector, 30 degrees
  const int steps_per_period = 10;                            // the controller runs at 10 Hz
  fb_real wanted[4];
  fb_momentum momentum = {{0}, {0}};
  double error = 0, bend = 0, wheel = 0, total = 0;
  fb_status status = make_hub();
  status = status ? status : make_boom();
  status = status ? status : make_craft();
  status = status ? status : fb_system_state_init(&craft, model, &state, &work, NULL, NULL); // at rest
  fb_quat_from_rotvec(wanted, turn);
  for (int k = 0; k < 120 * 100 && status == FB_OK; k++) { // 120 s, steps of 10 ms
    if (k % steps_per_period == 0) {
      status = fb_system_motion_eval(&craft, model, &work, &motion, &state, &input);
      error = control(wanted);
    }
    status = status ? status : fb_system_rk4_step(&craft, model, &state, &work, &input, &input, &input, FB_R(0.01));
    status = status ? status : fb_system_momentum_eval(&craft, model, &work, &momentum, &state, &input);
    total = fmax(total, sqrt((double)fb_vec3_dot(momentum.angular, momentum.angular)));
    wheel = fmax(wheel, fabs((double)motion.motion[0].rotor_momentum[2]));
    for (int side = 0; side < 2 && status == FB_OK; side++) {
      fb_node_motion node;
      status = fb_body_node_motion_eval(&model[BOOM], &node, &motion.pose[1 + side], &motion.motion[1 + side], 1);
      bend = fmax(bend, fabs((double)node.displacement[1]));
    }
  }
  if (status != FB_OK) {
    printf("%s\n", fb_status_string(status));
    return 1;
  }
  printf("pointing error %.1e rad; bent by %.1f mm; momentum %.1e N m s, of a wheel %.2f N m s\n", error, 1000 * bend,
         total, wheel);
  if (!(error < 1e-4 && total < 1e-12 * wheel)) {
    printf("a check failed\n");
    return 1;
  }
  return fflush(stdout) == 0 ? 0 : 1;
}
