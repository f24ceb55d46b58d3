/* satellite.c - the satellite of examples/scenes/satellite_control.txt as a program: its loop at 100 Hz, whose command acts
   5 ms later, around steps of 1 ms. Prints the columns of the scene as CSV. */
#include "../../flexbeam.h"
#include <math.h>
#include <stdio.h>

enum { HUB, BOOM, WHEEL, MODELS };                   /* models */
enum { AT_HUB, AT_RIGHT, AT_LEFT, AT_WHEEL, PARTS }; /* bodies */

static fb_body model[MODELS];
static fb_build_work build_work;
static fb_system craft;
static fb_system_work work;
static fb_system_state state;
static fb_system_input input;
static fb_system_motion motion;

static fb_status make_models(void)
{
  const fb_section tube = {.mass = FB_R(0.5), .EI_y = 2000, .EI_z = 2000};
  const fb_beam_desc beam = {.length = 8, .n_element = 8, .n_station = 1, .station = {tube}};
  const fb_modes_desc keep = {.count = {2, 2}};
  const fb_build_desc hub = {
      .mass = 400, .inertia = {60, 60, 80}, .body = {.effects = FB_EFFECTS_RIGID, .base = FB_BASE_PRESCRIBED}};
  const fb_build_desc boom = {.n_part = 1,
                              .part = {{.n_node = 1, .node = {8}}},
                              .zeta = FB_R(0.005),
                              .body = {.effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING, .base = FB_BASE_PRESCRIBED}};
  const fb_build_desc wheel = {.mass = 5,
                               .inertia = {FB_R(0.03), FB_R(0.03), FB_R(0.05)},
                               .body = {.effects = FB_EFFECTS_RIGID, .base = FB_BASE_PRESCRIBED}};
  fb_status status = fb_body_build(&model[HUB], &build_work, &hub, NULL, NULL, 0);
  status = status ? status : fb_body_build(&model[BOOM], &build_work, &boom, &beam, &keep, 1);
  return status ? status : fb_body_build(&model[WHEEL], &build_work, &wheel, NULL, NULL, 0);
}

static fb_status make_craft(void)
{
  fb_system_desc desc = {.n_body = PARTS, .model = {HUB, BOOM, BOOM, WHEEL}};
  desc.joint[AT_HUB].kind = FB_JOINT_FREE;
  desc.joint[AT_HUB].parent = FB_GROUND;
  for (int k = AT_RIGHT; k <= AT_LEFT; k++) {
    desc.joint[k].kind = FB_JOINT_RIGID;
    desc.joint[k].position[0] = FB_R(0.5) * (k == AT_RIGHT ? 1 : -1);
  }
  desc.joint[AT_LEFT].attitude[3] = 1; /* half a turn about z */
  desc.joint[AT_WHEEL].kind = FB_JOINT_REVOLUTE;
  return fb_system_init(&craft, &work, model, &desc, MODELS);
}

/* 0.2 from 0 s to 30 s, at a rate proportional to 1 - cos. */
static double wanted(double t)
{
  const double turn = 2 * acos(-1) * fmin(t / 30, 1);
  return 0.2 * (turn - sin(turn)) / (2 * acos(-1));
}

/* Torque of the wheel from attitude and rate of the hub, 5 N m at most. */
static double command(double t)
{
  const double off = wanted(t) - 2 * (double)motion.pose[AT_HUB].quat[3] - 5 * (double)motion.motion[AT_HUB].w[2];
  return fmax(-5, fmin(5, -40 * off));
}

static fb_status row(double t)
{
  fb_node_motion hub, tip;
  fb_momentum momentum;
  fb_status status = fb_body_node_motion_eval(&model[HUB], &hub, &motion.pose[AT_HUB], &motion.motion[AT_HUB], 0);
  status = status ? status
                  : fb_body_node_motion_eval(&model[BOOM], &tip, &motion.pose[AT_RIGHT], &motion.motion[AT_RIGHT], 1);
  status = status ? status : fb_system_momentum_eval(&craft, model, &work, &momentum, &state, &input);
  if (status == FB_OK) {
    printf("%.12g,%.12g,%.12g,%.12g,%.12g,%.12g,%.12g\n", t, (double)hub.quat[3], (double)motion.motion[AT_HUB].w[2],
           (double)tip.displacement[1], (double)motion.joint[AT_WHEEL].speed[0], (double)momentum.angular[2],
           (double)input.drive[AT_WHEEL].torque[0]);
  }
  return status;
}

int main(void)
{
  double next = 0;
  fb_status status = make_models();
  status = status ? status : make_craft();
  status = status ? status : fb_system_state_init(&craft, model, &state, &work, NULL, NULL); /* at rest */
  printf("t,turn,rate,bend,wheel,momentum,torque\n");
  for (int k = 0; k <= 60000 && status == FB_OK; k++) {
    status = fb_system_motion_eval(&craft, model, &work, &motion, &state, &input);
    status = status || k % 100 ? status : row(0.001 * k);
    if (k % 10 == 0) {
      next = command(0.001 * k);
    } else if (k % 10 == 5) {
      input.drive[AT_WHEEL].torque[0] = (fb_real)next;
    }
    status = status ? status : fb_system_rk4_step(&craft, model, &state, &work, &input, &input, &input, FB_R(0.001));
  }
  if (status != FB_OK) {
    printf("%s\n", fb_status_string(status));
  }
  return status != FB_OK;
}
