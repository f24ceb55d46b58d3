/* boom.h - the reference boom, that of [DB] 4.3 and of the spin-up: uniform, slender, alike in both planes, first
   bending frequency 3.798 rad/s. Its numbers, its beam, and what programs make of it. Include flexbeam.h first. */
#ifndef BOOM_H
#define BOOM_H
#include <string.h>

#define BOOM_LENGTH 10.0                    /* [m] */
#define BOOM_MASS 12.0                      /* [kg] */
#define BOOM_EI 14004.0                     /* [N m^2] in both planes */
#define BOOM_EA 3.1724e7                    /* [N] */
#define BOOM_LINE (BOOM_MASS / BOOM_LENGTH) /* [kg/m] */

/* The beam, and how it may deform. */
typedef struct boom {
  double length, mass, EI, EA; /* [m], [kg], [N m^2], [N] */
  int planes;                  /* of bending: 1 (along y) or 2 */
  int modes;                   /* bending modes per plane, where elements is 0 */
  int elements, degree;        /* with axial coordinates and nonlinear strain; degree of the functions, 0: cubic */
  int root_strain;             /* with elements: u_x' free at the root */
} boom;

/* The beam alone: n_element elements for its modes. */
static inline void boom_beam(fb_beam_desc *desc, const boom *b, int n_element)
{
  memset(desc, 0, sizeof *desc);
  desc->length = (fb_real)b->length;
  desc->n_element = n_element;
  desc->n_station = 1;
  desc->station[0].mass = (fb_real)(b->mass / b->length);
  desc->station[0].EA = (fb_real)b->EA;
  desc->station[0].EI_z = (fb_real)b->EI;
  desc->station[0].EI_y = b->planes > 1 ? (fb_real)b->EI : FB_R(0.0);
}

#if FB_WITH_FORMS
static fb_form_torque boom_torque; /* stiffness torque as printed, of the last boom_shape with elements */
#endif

/* Shape integrals of the boom clamped at the origin, and the node of its tip. */
static inline fb_status boom_shape(fb_shape *shape, int *tip, const boom *b)
{
  static fb_beam_desc desc;
  static fb_beam beam;
  static fb_modes basis;
  static fb_modes_work work;
  const int count = b->elements ? FB_ALL_MODES : b->modes;
  fb_modes_desc keep;
  fb_status status;
  memset(&keep, 0, sizeof keep);
  boom_beam(&desc, b, b->elements ? b->elements : FB_MAX_ELEMENTS);
  keep.count[FB_KIND_BEND_Y] = count;
  keep.count[FB_KIND_BEND_Z] = b->planes > 1 ? count : 0;
  if (b->elements) {
    keep.basis = FB_BASIS_FUNCTIONS;
    keep.count[FB_KIND_AXIAL] = count;
    keep.degree = b->degree;
    keep.root_strain = b->root_strain;
  }
  status = fb_beam_init(&beam, &desc);
  status = status ? status : fb_modes_solve(&basis, &work, &beam, &keep);
  status = status ? status : fb_shape_init(shape, basis.n);
  status = status ? status : fb_shape_add_beam(shape, 0, &beam, &basis);
#if FB_WITH_NONLINEAR_STRAIN
  if (b->elements) {
    status = status ? status : fb_shape_add_beam_strain(shape, 0, &beam, &basis);
  }
#endif
#if FB_WITH_FORMS
  memset(&boom_torque, 0, sizeof boom_torque);
  if (b->elements) {
    status = status ? status : fb_form_torque_add_beam(&boom_torque, shape, 0, &beam, &basis);
  }
#endif
  return status ? status : fb_shape_add_beam_node(shape, tip, 0, &beam, &basis, desc.length);
}

/* The reference boom on a rigid hub of 500 kg: natural modes along y, z and x, each damped by zeta where damping is
   among the effects, with three wheels on the hub where rotors are. points: along the boom, for large deflection; 0: as
   many as the library takes. */
static inline fb_status boom_craft_points(fb_body *body, fb_base base, int y, int z, int axial, unsigned effects,
                                          fb_real zeta, int points)
{
  static const fb_real center[3] = {0}, inertia[6] = {80, 80, 80}; /* [m], [kg m^2] of the hub */
  static const boom reference = {BOOM_LENGTH, BOOM_MASS, BOOM_EI, BOOM_EA, 2, 0, 0, 0, 0};
  static fb_beam_desc beam_desc;
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_shape shape;
  static fb_body_work body_work;
  fb_modes_desc keep;
  fb_body_desc desc;
  fb_status status;
  memset(&keep, 0, sizeof keep);
  memset(&desc, 0, sizeof desc);
  boom_beam(&beam_desc, &reference, 8); /* twelve bending modes at most */
  keep.count[FB_KIND_BEND_Y] = y;
  keep.count[FB_KIND_BEND_Z] = z;
  keep.count[FB_KIND_AXIAL] = axial;
  keep.line_points = points;
  desc.effects = effects;
  desc.base = base;
  desc.allow_split_effects = 1;                                            /* to time residual inertia alone */
  desc.gravity[2] = effects & FB_EFFECT_GRAVITY ? FB_R(-9.81) : FB_R(0.0); /* [m/s^2] */
  for (int k = 0; k < FB_MAX_MODES; k++) {
    desc.zeta[k] = effects & FB_EFFECT_DAMPING ? zeta : FB_R(0.0);
  }
#if FB_WITH_ROTORS
  for (int r = 0; r < 3 && r < FB_MAX_ROTORS && (effects & FB_EFFECT_ROTORS); r++) {
    desc.rotor[r].axis[r] = FB_R(1.0);
    desc.rotor[r].inertia = FB_R(0.1); /* [kg m^2] */
    desc.n_rotor = r + 1;
  }
#endif
  status = fb_beam_init(&beam, &beam_desc);
  status = status ? status : fb_modes_solve(&modes, &modes_work, &beam, &keep);
  status = status ? status : fb_shape_init(&shape, modes.n);
  status = status ? status : fb_shape_add_rigid(&shape, 500, center, inertia);
  status = status ? status : fb_shape_add_beam(&shape, 0, &beam, &modes);
  return status ? status : fb_body_init(body, &body_work, &shape, &desc);
}

static inline fb_status boom_craft(fb_body *body, fb_base base, int y, int z, int axial, unsigned effects, fb_real zeta)
{
  return boom_craft_points(body, base, y, z, axial, effects, zeta, 0);
}

#endif
