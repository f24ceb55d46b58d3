/* sets.h - the sets of effects that benchmarks step, and the states of the reference boom on its hub. */
#ifndef FBB_SETS_H
#define FBB_SETS_H

#include "check.h"
#include "random.h"
#include "../examples/common/boom.h"

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
