/* Size of fb_body, and which effects this build refuses; removed.sh measures its object. */
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"
#include <stdio.h>

int main(void)
{
  static const unsigned effects[] = {FB_EFFECT_SPIN_COUPLING,
                                     FB_EFFECT_SPIN_COUPLING | FB_EFFECT_RESIDUAL_INERTIA | FB_EFFECT_SPIN_STIFFENING,
                                     FB_EFFECT_SPIN_STIFFENING,
                                     FB_EFFECT_ACCELERATION_STIFFENING,
                                     FB_EFFECT_DAMPING,
                                     FB_EFFECT_GRAVITY,
                                     FB_EFFECT_NONLINEAR_STRAIN,
                                     FB_EFFECTS_LARGE,
                                     FB_EFFECT_ROTORS};
  static fb_shape shape;
  static fb_body body;
  static fb_body_work work;
  static const fb_real r[3] = {0}, inertia[6] = {1, 1, 1};
  if (fb_effects_check(FB_EFFECTS_LINEAR) != FB_OK || fb_shape_init(&shape, 0) != FB_OK ||
      fb_shape_add_rigid(&shape, 1, r, inertia) != FB_OK) {
    return 1;
  }
#if FB_WITH_NONLINEAR_STRAIN
  shape.n_strain = 4; /* an effect without its data is refused, too */
#endif
  printf("%d ", (int)sizeof(fb_body));
  for (int k = 0; k < 9; k++) { /* refused by the check, and by fb_body_init: 1 */
    fb_body_desc desc = {0};
    fb_status status;
    desc.effects = effects[k] | FB_EFFECT_ELASTIC;
    desc.allow_split_effects = 1;
#if FB_WITH_ROTORS
    desc.n_rotor = effects[k] == FB_EFFECT_ROTORS; /* the effect of what it describes */
    desc.rotor[0].axis[2] = desc.rotor[0].inertia = (fb_real)desc.n_rotor;
#endif
    status = fb_body_init(&body, &work, &shape, &desc);
    if (status != fb_effects_check(desc.effects) || (status != FB_OK && status != FB_ERR_EFFECTS)) {
      return 1;
    }
    printf("%d", status == FB_ERR_EFFECTS);
  }
  for (unsigned set = 0; set < 512;
       set++) { /* large deflection: the check says what fb_body_init takes, on a free base, too */
    fb_body_desc desc = {0};
    desc.effects = set | FB_EFFECT_LARGE_DEFLECTION;
    if (fb_body_init(&body, &work, &shape, &desc) != fb_effects_check(desc.effects)) {
      return 1;
    }
  }
  printf("\n");
  return 0;
}
