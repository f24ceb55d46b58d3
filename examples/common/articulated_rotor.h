/* articulated_rotor.h - flexible blades on hinges for flap and lag and pitch bearings, on a shaft that is driven.
   At the offset each blade hangs on a universal joint, its cross without mass, and on that by its bearing. Include
   flexbeam.h and check.h before, with 1 + 2 BLADES bodies. */
#ifndef ARTICULATED_ROTOR_H
#define ARTICULATED_ROTOR_H
#include "rigid_rotor.h"

enum { TIP = STRIPS + 1 }; /* nodes of a blade: strips 1 to 4, then the tip */
enum { HUB_MODEL, CROSS_MODEL, BLADE_MODEL, MODELS };
enum { LAG, FLAP };            /* axes of the hinge */
#define CROSS(k) (1 + 2 * (k)) /* bodies of blade k; the hub is body 0 */
#define BLADE(k) (2 + 2 * (k))

typedef struct fidelity { /* of a run */
  const char *name;
  int flexible, lag; /* 0: blades rigid, lag hinge locked */
  double GJ;         /* [N m^2] of blades that also twist, as lines of large deflection; 0: they do not */
  double zeta;       /* damping ratio of their modes */
} fidelity;

/* A uniform blade along x, y toward its leading edge: two bending modes of flap, one of lag, perhaps one of torsion,
   clamped to the pitch bearing. The crosses of the hinges have no mass. */
static inline void make_bodies(fb_body model[MODELS], const rotor_data *d, const fidelity *f)
{
  static fb_build_work scratch;
  const fb_real length = (fb_real)(d->radius - d->offset);
  const fb_build_desc cross = {.body = {.base = FB_BASE_PRESCRIBED}};
  const fb_build_desc hub = {.mass = 100, .inertia = {20, 20, 40}, .body = {.base = FB_BASE_PRESCRIBED}};
  const fb_section plate = {.mass = (fb_real)d->mass, /* as wide as the chord */
                            .EI_y = (fb_real)d->ei_flap,
                            .EI_z = (fb_real)d->ei_lag,
                            .GJ = (fb_real)f->GJ,
                            .i_z = (fb_real)(d->mass * d->chord * d->chord / 12)};
  const fb_beam_desc beam = {.length = length, .n_element = 8, .n_station = 1, .station = {plate}};
  const fb_modes_desc keep = {.count = {1, 2, 0, f->GJ > 0}};
  const unsigned bends =
      (f->GJ > 0 ? FB_EFFECTS_LARGE : FB_EFFECTS_FULL) | (f->zeta > 0 ? (unsigned)FB_EFFECT_DAMPING : 0u);
  fb_build_desc blade = {
      .n_part = 1,
      .part = {{.n_node = TIP, .node = {[STRIPS] = length}}},
      .zeta = (fb_real)f->zeta,
      .body = {.effects = f->flexible ? bends : (unsigned)FB_EFFECTS_RIGID, .base = FB_BASE_PRESCRIBED}};
  for (int i = 0; i < STRIPS; i++) {
    blade.part[0].node[i] = (fb_real)(strip_radius(d, i) - d->offset);
  }
  need(fb_body_build(&model[CROSS_MODEL], &scratch, &cross, NULL, NULL, 0), "cross");
  need(fb_body_build(&model[HUB_MODEL], &scratch, &hub, NULL, NULL, 0), "hub");
  need(fb_body_build(&model[BLADE_MODEL], &scratch, &blade, &beam, &keep, 1), "blade");
}

static inline void turn(fb_real quat[4], double angle)
{
  const fb_real phi[3] = {0, 0, (fb_real)angle};
  fb_quat_from_rotvec(quat, phi);
}

/* Hinge of blade k: its z is the shaft's (lag, forward), its x points to the trailing edge (flap, up), its y along the
   blade. The pitch bearing turns about the blade, nose up. */
static inline void make_rotor(fb_system *rotor, fb_body model[MODELS], fb_system_work *work, const rotor_data *d,
                              const fidelity *f)
{
  fb_system_desc desc = {.n_body = 1 + 2 * BLADES};
  make_bodies(model, d, f);
  desc.joint[0] = (fb_joint_desc){.kind = FB_JOINT_REVOLUTE, .parent = FB_GROUND, .mode = {FB_AXIS_PRESCRIBED}};
  for (int k = 0; k < BLADES; k++) {
    fb_joint_desc *const hinge = &desc.joint[CROSS(k)], *const bearing = &desc.joint[BLADE(k)];
    const double azimuth = blade_azimuth(k);
    desc.model[CROSS(k)] = CROSS_MODEL;
    desc.model[BLADE(k)] = BLADE_MODEL;
    hinge->kind = FB_JOINT_UNIVERSAL;
    hinge->position[0] = (fb_real)(d->offset * cos(azimuth));
    hinge->position[1] = (fb_real)(d->offset * sin(azimuth));
    turn(hinge->attitude, azimuth - 0.5 * pi);
    turn(hinge->child_attitude, -0.5 * pi);
    hinge->stiffness[FLAP] = (fb_real)d->flap_spring;
    hinge->damping[LAG] = (fb_real)d->lag_damper;
    hinge->mode[LAG] = f->lag ? FB_AXIS_FREE : FB_AXIS_LOCKED;
    bearing->kind = FB_JOINT_REVOLUTE;
    bearing->parent = CROSS(k);
    bearing->axis[0] = 1;
    bearing->mode[0] = FB_AXIS_PRESCRIBED;
  }
  need(fb_system_init(rotor, work, model, &desc, MODELS), "system");
}

/* Shaft and pitch at time t. */
static inline void set_drives(fb_system_input *input, const rotor_data *d, double t)
{
  const double W = d->spin, azimuth = fmod(W * t, 2 * pi);
  input->drive[0].value[0] = (fb_real)azimuth;
  input->drive[0].rate[0] = (fb_real)W;
  for (int k = 0; k < BLADES; k++) {
    fb_drive *pitch = &input->drive[BLADE(k)];
    const double c = cos(azimuth + blade_azimuth(k)), s = sin(azimuth + blade_azimuth(k));
    const double wave = degree * (d->cyclic_cos * c + d->cyclic_sin * s);
    pitch->value[0] = (fb_real)(degree * d->collective + wave);
    pitch->rate[0] = (fb_real)(W * degree * (d->cyclic_sin * c - d->cyclic_cos * s));
    pitch->acceleration[0] = (fb_real)(-W * W * wave);
  }
}
#endif
