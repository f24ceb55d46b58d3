/* The lines of C that flexbeam advise prints for examples/boom.txt, compiled and run: LINES is the file that holds
   them, WORK the scratch of their integrator. */
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"
#include <stdio.h>

int main(void)
{
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_shape shape, selected;
  static fb_body body;
  static fb_body_work body_work;
  static fb_exponential integrator;
  static WORK work;
  static fb_input start, middle, end;
  const fb_section section = {.mass = FB_R(1.2), .EI_y = 14004, .EI_z = 14004};
  const fb_beam_desc boom = {.length = 10, .n_element = 10, .n_station = 1, .station = {section}};
  const fb_modes_desc bending = {.count = {5, 5}};
  fb_state state = {.quat = {FB_R(1.0)}};
  fb_status status = fb_beam_init(&beam, &boom);
  status = status ? status : fb_modes_solve(&modes, &modes_work, &beam, &bending);
  status = status ? status : fb_shape_init(&shape, modes.n);
  status = status ? status : fb_shape_add_beam(&shape, 0, &beam, &modes);
  if (status != FB_OK) {
    printf("the beam: %s\n", fb_status_string(status));
    return 1;
  }
#include LINES
  printf("%s: %d modes, %d terms of Lambda, %d of S\n", fb_status_string(status), body.n, body.n_lambda, body.n_S);
  (void)integrator;
  (void)start;
  (void)end;
  (void)middle;
  return status != FB_OK;
}
