/* The smallest whole program: a boom on a hub, turned by a torque for a second. It is the QUICK START of flexbeam.h. */
#define FB_WITH_DETAIL 1   // says what was refused
#define FB_WITH_OPTIONAL 0 // 1: rotors, beams that bend far; twice the compile time
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"
#include <stdio.h>

static fb_body body;
static fb_build_work build_work;

int main(void)
{
  const fb_section uniform = {.mass = FB_R(1.2), .EI_y = 14004, .EI_z = 14004}; // [kg/m], [N m^2]
  const fb_beam_desc boom = {.length = 10, .n_element = 10, .n_station = 1, .station = {uniform}};
  const fb_modes_desc keep = {.count = {3, 3}}; // bending modes along y, along z
  const fb_build_desc craft = {.mass = 500,     // of the hub [kg], [kg m^2]
                               .inertia = {80, 80, 80},
                               .n_part = 1, // the boom; its tip is node 1
                               .part = {{.n_node = 1, .node = {10}}},
                               .body = {.effects = FB_EFFECTS_FULL}}; // FB_EFFECTS_LARGE and OPTIONAL 1: bends far
  const fb_input torque = {.n_load = 1, .load = {{.torque = {0, 0, 160}}}}; // [N m] at node 0, inertial axes
  fb_state state;
  fb_rk4_work work;
  fb_motion motion;
  fb_node_motion tip;
  fb_status status = fb_body_build(&body, &build_work, &craft, &boom, &keep, 1); // on the desktop or at start-up
  status = status ? status : fb_state_init(&body, &state);
  for (int k = 0; k < 1000 && status == FB_OK; k++) { // run: one step of 1 ms
    status = fb_rk4_step(&body, &state, &work, &torque, &torque, &torque, FB_R(0.001));
  }
  status = status ? status : fb_body_motion_eval(&body, &motion, &state, &torque);
  status = status ? status : fb_body_node_motion_eval(&body, &tip, &state, &motion, 1);
  if (status != FB_OK) {
    printf("%s\n", fb_status_string(status));
    const fb_detail *no = fb_detail_last();
    if (no->status == status) { // this refusal has a record: what it wants, what it found
      printf("%s: %s %g: %g\n", no->function, no->what, (double)no->need, (double)no->have);
    }
    return 1;
  }
  printf("after 1 s: hub %.4f rad/s, tip %.4f m\n", (double)motion.w[2], (double)tip.displacement[1]);
  return fflush(stdout) == 0 ? 0 : 1;
}
