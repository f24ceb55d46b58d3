/* Writes the ROM header of a body with rotors, which no description has. usage: rom_rotors [--single] */
#define FBI_WITH_TEXT
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"
#include "../../examples/tools/rom.h"
#include <stdio.h>

int main(int argc, char **argv)
{
  static fb_build_work work;
  static fb_body body;
  const fb_beam_desc boom = {
      .length = 3, .n_element = 6, .n_station = 1, .station = {{.mass = FB_R(0.5), .EI_y = 200, .EI_z = 300}}};
  const fb_modes_desc keep = {.count = {1, 1}};
  fb_build_desc desc = {.mass = 50, .inertia = {5, 6, 7}, .n_part = 1, .part = {{.n_node = 1, .node = {3}}}};
  desc.body.effects = FB_EFFECTS_FULL;
  desc.body.mu = FB_R(4e5);
  desc.body.center[0] = -FB_R(300.0);
  desc.body.n_rotor = 2;
  desc.body.rotor[0].axis[2] = FB_R(1.0);
  desc.body.rotor[0].inertia = FB_R(0.02);
  desc.body.rotor[0].given = 1;
  desc.body.rotor[1] = desc.body.rotor[0];
  desc.body.rotor[1].given = 0;
  desc.body.rotor[1].node = 1;
  desc.body.rotor[1].axis[0] = FB_R(0.3);
  desc.body.rotor[1].damping = FB_R(1e-4);
  desc.body.rotor[1].friction = FB_R(1e-3);
  desc.body.rotor[1].friction_speed = FB_R(0.2);
  desc.body.rotor[1].static_imbalance = FB_R(1e-5);
  desc.body.rotor[1].dynamic_imbalance = FB_R(2e-5);
  desc.body.rotor[1].dynamic_phase = FB_R(0.7);
  if (fb_body_build(&body, &work, &desc, &boom, &keep, 1) != FB_OK) {
    return 1;
  }
  (void)argv;
  rom_write(stdout, &body, "rom_body", "rotors", argc > 1);
  return 0;
}
