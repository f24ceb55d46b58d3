/* spinup.h - the beam that [DB] 4.3 and the spin-up turn about z: 10 m, 12 kg, its root at the axis. */
#ifndef FBB_SPINUP_H
#define FBB_SPINUP_H

#include "check.h"

/* Bending modes in each of 1 or 2 planes or, where n_element is not 0, cubic elements with axial coordinates, nonlinear
   strain and u_x' free at the root. Returns the node of the tip. */
static int fbb_spinup_shape(fb_shape *shape, int modes, int n_element, int planes)
{
  static fb_beam_desc desc;
  static fb_beam beam;
  static fb_modes basis;
  static fb_modes_work work;
  fb_modes_desc keep;
  int tip = 0;
  memset(&desc, 0, sizeof desc);
  desc.length = 10; /* [m] */
  desc.n_element = n_element ? n_element : FB_MAX_ELEMENTS;
  desc.n_station = 1;
  desc.station[0].mass = FB_R(1.2);     /* [kg/m] */
  desc.station[0].EA = FB_R(3.1724e7);  /* [N] */
  desc.station[0].EI_z = FB_R(14004.0); /* [N m^2] */
  desc.station[0].EI_y = planes > 1 ? FB_R(14004.0) : FB_R(0.0);
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Y] = n_element ? FB_ALL_MODES : modes;
  keep.count[FB_KIND_BEND_Z] = planes > 1 ? keep.count[FB_KIND_BEND_Y] : 0;
  if (n_element) {
    keep.basis = FB_BASIS_FUNCTIONS;
    keep.count[FB_KIND_AXIAL] = FB_ALL_MODES;
    keep.root_strain = 1;
  }
  fbb_check(fb_beam_init(&beam, &desc), "beam");
  fbb_check(fb_modes_solve(&basis, &work, &beam, &keep), "basis");
  fbb_check(fb_shape_init(shape, basis.n), "shape");
  fbb_check(fb_shape_add_beam(shape, 0, &beam, &basis), "shape integrals");
  if (n_element) {
    fbb_check(fb_shape_add_beam_strain(shape, 0, &beam, &basis), "strain stations");
  }
  fbb_check(fb_shape_add_beam_node(shape, &tip, 0, &beam, &basis, desc.length), "tip");
  return tip;
}

#endif
