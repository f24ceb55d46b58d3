/* scene.h - what the benchmarks step: a uniform boom on a rigid hub, unloaded, and the sets of effects. */
#ifndef FBB_SCENE_H
#define FBB_SCENE_H

#include "check.h"
#include "random.h"

#define FBB_COUNT(array) ((int)(sizeof(array) / sizeof((array)[0])))

typedef struct fbb_set {
  const char *name;
  unsigned effects;
} fbb_set;

static const fbb_set fbb_sets[] = {
    {"rigid", FB_EFFECTS_RIGID},
    {"linear", FB_EFFECTS_LINEAR},
    {"spin", FB_EFFECTS_SPIN},
    {"residual", FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA},
    {"stiffening", FB_EFFECTS_SPIN | FB_EFFECT_SPIN_STIFFENING},
    {"full", FB_EFFECTS_FULL},
    {"full+damping", FB_EFFECTS_FULL | FB_EFFECT_DAMPING},
    {"full+gravity", FB_EFFECTS_FULL | FB_EFFECT_GRAVITY},
    {"full+both", FB_EFFECTS_FULL | FB_EFFECT_DAMPING | FB_EFFECT_GRAVITY},
};

/* The body with y and z bending modes and axial ones; zeta damps each mode where damping is among the effects. */
static void fbb_body(fb_body *body, fb_base base, int y, int z, int axial, unsigned effects, fb_real zeta)
{
  static const fb_real center[3] = {0}, inertia[6] = {80, 80, 80}; /* [m], [kg m^2] of the hub */
  static fb_beam_desc boom;
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_shape shape;
  static fb_body_work body_work;
  fb_modes_desc keep;
  fb_body_desc desc;
  memset(&boom, 0, sizeof boom);
  boom.length = 10;   /* [m] */
  boom.n_element = 8; /* twelve bending modes at most */
  boom.n_station = 1;
  boom.station[0].mass = FB_R(1.2);                            /* [kg/m] */
  boom.station[0].EA = FB_R(3.1724e7);                         /* [N] */
  boom.station[0].EI_y = boom.station[0].EI_z = FB_R(14004.0); /* [N m^2] */
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Y] = y;
  keep.count[FB_KIND_BEND_Z] = z;
  keep.count[FB_KIND_AXIAL] = axial;
  memset(&desc, 0, sizeof desc);
  desc.effects = effects;
  desc.base = base;
  desc.allow_split_effects = 1;  /* to time residual inertia alone */
  desc.gravity[2] = FB_R(-9.81); /* [m/s^2] */
  for (int k = 0; k < FB_MAX_MODES; k++) {
    desc.zeta[k] = zeta;
  }
  fbb_check(fb_beam_init(&beam, &boom), "beam");
  fbb_check(fb_modes_solve(&modes, &modes_work, &beam, &keep), "modes");
  fbb_check(fb_shape_init(&shape, modes.n), "shape");
  fbb_check(fb_shape_add_rigid(&shape, 500, center, inertia), "hub");
  fbb_check(fb_shape_add_beam(&shape, 0, &beam, &modes), "boom");
  fbb_check(fb_body_init(body, &body_work, &shape, &desc), "body");
}

/* State number k, each different: deflected up to amplitude [sqrt(kg) m], spinning up to spin [rad/s]; without spin at
   rest, its momenta exactly zero. */
static void fbb_state(fb_state *state, const fb_body *body, int k, fb_real spin, fb_real amplitude)
{
  const fb_real v[3] = {0};
  fb_real w[3];
  fbb_check(fb_state_init(body, state), "state");
  for (int a = 0; a < body->n; a++) {
    state->q[a] = amplitude * fbb_random(100 * k + a);
  }
  for (int i = 0; i < 3; i++) {
    w[i] = spin * fbb_random(100 * k + 90 + i);
  }
  if (spin > FB_R(0.0)) {
    fbb_check(fb_state_from_velocity(body, state, v, w, NULL), "state");
  }
}

#endif
