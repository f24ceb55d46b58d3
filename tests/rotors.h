/* rotors.h - bodies with rotors, shared by the tests of >>body and >>linear: rigid ones, and the boom of body.h. */
#ifndef FBT_ROTORS_H
#define FBT_ROTORS_H

#include "body.h"
#if FB_WITH_ROTORS

static fb_body_desc desc;
static fb_state state;
static fb_input input;
static fb_motion motion;

static inline void fresh(fb_base base, unsigned effects)
{
  memset(&desc, 0, sizeof desc);
  memset(&input, 0, sizeof input);
  desc.base = base;
  desc.effects = effects;
}

/* One more rotor; x, y, z: its axis. */
static inline fb_rotor *rotor_add(int node, double x, double y, double z, double inertia)
{
  fb_rotor *const rotor = &desc.rotor[desc.n_rotor++];
  rotor->node = node;
  rotor->axis[0] = (fb_real)x;
  rotor->axis[1] = (fb_real)y;
  rotor->axis[2] = (fb_real)z;
  rotor->inertia = (fb_real)inertia;
  return rotor;
}

/* A rigid body with these moments of inertia about O, its mass center at `arm` on z. */
static inline void rigid_hub(double mass, double arm, double jx, double jy, double jz)
{
  const double shift = mass * arm * arm;
  const fb_real center[3] = {0, 0, (fb_real)arm};
  const fb_real inertia[6] = {(fb_real)(jx - shift), (fb_real)(jy - shift), (fb_real)jz, 0, 0, 0};
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)mass, center, inertia), FB_OK);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  FBT_INT_EQ(fb_body_check(&body), FB_OK);
}

/* Angular velocity of the body and speeds of its rotors. */
static inline void spin_up(double x, double y, double z, const double *speed)
{
  const fb_real still[3] = {0, 0, 0}, w[3] = {(fb_real)x, (fb_real)y, (fb_real)z};
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, still, w, NULL), FB_OK);
  for (int r = 0; r < body.n_rotor; r++) {
    FBT_INT_EQ(fb_state_rotor_set(&body, &state, r, (fb_real)speed[r], 0, NULL), FB_OK);
  }
}

static const unsigned sets[] = {FB_EFFECTS_LINEAR, FB_EFFECTS_SPIN, FB_EFFECTS_FULL, FB_EFFECTS_LARGE};

/* The boom of body.h with a wheel on the hub and, of n = 3, one on its tip and one along it. */
static inline void craft_of(int n, unsigned effects, fb_base base, int friction)
{
  int node[2];
  fresh(base, effects);
  desc.deflection_limit = FB_R(2.0);
  boom(&shape, node);
  rotor_add(0, 0.3, -0.5, 1.0, 0.05);
  if (n == 3) {
    rotor_add(node[0], 1.0, 0.4, 0.2, 0.004);
    rotor_add(node[1], -0.2, 1.0, 0.7, 0.008);
  }
  for (int r = 0; r < n && friction; r++) {
    desc.rotor[r].damping = FB_R(1e-4);
    desc.rotor[r].friction = FB_R(2e-3);
    desc.rotor[r].friction_speed = FB_R(2.0);
  }
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  FBT_INT_EQ(fb_body_check(&body), FB_OK);
  FBT_INT_EQ(body.rotor[0].moves, 0);
  FBT_INT_EQ(n < 3 || body.rotor[1].moves, 1);
}

static inline void craft(unsigned effects, fb_base base, int friction)
{
  craft_of(3, effects, base, friction);
}

static inline void craft_moves(double size)
{
  static const double speed[3] = {20.0, -60.0, 45.0};
  boom_state(&state, size);
  for (int r = 0; r < body.n_rotor; r++) {
    FBT_INT_EQ(fb_state_rotor_set(&body, &state, r, (fb_real)speed[r], FB_R(0.3), &input), FB_OK);
  }
}
#endif

#endif
