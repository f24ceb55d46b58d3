/* solar_array.h - a pair of flexible solar arrays on drives, along +y and -y of a hub that is body 0 of its system.
   Include flexbeam.h before. */
#ifndef SOLAR_ARRAY_H
#define SOLAR_ARRAY_H
#include <math.h>
#include <string.h>

typedef struct solar_array {
  double length, width;      /* [m] */
  double root;               /* [m] of the drive from the hub's origin */
  double mass;               /* [kg] of one array */
  double frequency, damping; /* [Hz] first bending out of plane, clamped; ratio of every mode */
  double fitting;            /* [kg m^2] of the drive's turning part, about every axis */
} solar_array;

/* A plate as a beam along x, soft in bending along its normal z. Two modes out of plane, one in plane, one of
   torsion. tip: the node there. */
static inline fb_status solar_array_init(fb_body *body, int *tip, fb_beam *beam, fb_modes *modes, const solar_array *a)
{
  static fb_modes_work modes_work;
  static fb_beam_desc desc;
  static fb_shape shape;
  static fb_body_work scratch;
  const fb_real J = (fb_real)a->fitting, inertia[6] = {J, J, J, 0, 0, 0}, center[3] = {0};
  const fb_modes_desc keep = {.count = {1, 2, 0, 1}};
  fb_body_desc level = {.base = FB_BASE_PRESCRIBED, .effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING};
  const double pi = 3.14159265358979324, L = a->length, m = a->mass / L; /* [kg/m] */
  const double EI = m * pow(2 * pi * a->frequency * L * L / 3.516, 2);   /* of the clamped first mode */
  const double i = m * a->width * a->width / 12;
  fb_status status;
  desc.length = (fb_real)L;
  desc.n_element = 8;
  desc.n_station = 1;
  desc.station[0].mass = (fb_real)m;
  desc.station[0].EI_y = (fb_real)EI;
  desc.station[0].EI_z = (fb_real)(16 * EI);                            /* in plane four times the frequency */
  desc.station[0].GJ = (fb_real)(i * pow(4 * L * 5 * a->frequency, 2)); /* torsion five times */
  desc.station[0].i_z = (fb_real)i;
  for (int k = 0; k < FB_MAX_MODES; k++) {
    level.zeta[k] = (fb_real)a->damping;
  }
  status = fb_beam_init(beam, &desc);
  status = status ? status : fb_modes_solve(modes, &modes_work, beam, &keep);
  status = status ? status : fb_shape_init(&shape, modes->n);
  status = status ? status : fb_shape_add_rigid(&shape, 0, center, inertia);
  status = status ? status : fb_shape_add_beam(&shape, 0, beam, modes);
  status = status ? status : fb_shape_add_beam_node(&shape, tip, 0, beam, modes, (fb_real)L);
  return status ? status : fb_body_init(body, &scratch, &shape, &level);
}

/* The drive at +y (side 1) or -y (-1). Joint axes: z out of the hub, along the array's x; at zero both arrays lie in
   the hub's xy plane. */
static inline void solar_array_hang(fb_joint_desc *joint, const solar_array *a, int side)
{
  const double s = sqrt(0.5);
  const fb_real right[4] = {(fb_real)s, (fb_real)-s, 0, 0}; /* -90 degrees about x: z to y of the hub */
  const fb_real left[4] = {0, 0, (fb_real)-s, (fb_real)s};  /* that, then half a turn about z */
  const fb_real on_array[4] = {FB_R(0.5), FB_R(-0.5), FB_R(0.5), FB_R(-0.5)};
  joint->kind = FB_JOINT_REVOLUTE;
  joint->parent = 0;
  joint->position[1] = (fb_real)(side * a->root);
  memcpy(joint->attitude, side > 0 ? right : left, sizeof right);
  memcpy(joint->child_attitude, on_array, sizeof on_array);
}

/* Adds both arrays, undeformed, to the moments of inertia about the hub's axes. */
static inline void solar_array_add_inertia(double J[3], const solar_array *a)
{
  const double L = a->length, m = a->mass;
  const double across = m * (a->root * a->root + a->root * L + L * L / 3), along = m * a->width * a->width / 12;
  J[0] += 2 * across + 2 * a->fitting;
  J[1] += 2 * along + 2 * a->fitting;
  J[2] += 2 * across + 2 * along + 2 * a->fitting;
}

/* The frequency [rad/s] at which hub and arrays swing against each other about x, J the whole's moment of inertia: the
   lowest root w of J - 2 sum_a h_a^2 w^2/(w^2 - w_a^2) = 0, with the angular momentum h_a about the hub's origin of the
   modes out of plane. It lies between the first two of the clamped array. */
static inline double solar_array_swing(const fb_modes *modes, const solar_array *array, double J)
{
  double h[2] = {0}, w[2] = {0}, low, high;
  int found = 0;
  for (int a = 0; a < modes->n && found < 2; a++) {
    if (modes->kind[a] == FB_KIND_BEND_Z) {
      w[found] = (double)modes->omega[a];
      h[found++] = (double)modes->momentum[6 * a + 2] * array->root - (double)modes->momentum[6 * a + 4];
    }
  }
  low = w[0];
  high = w[1];
  for (int k = 0; k < 60; k++) {
    const double x = 0.5 * (low + high);
    double sum = J;
    for (int a = 0; a < 2; a++) {
      sum -= 2 * h[a] * h[a] * x * x / (x * x - w[a] * w[a]);
    }
    *(sum < 0 ? &low : &high) = x;
  }
  return 0.5 * (low + high);
}
#endif
