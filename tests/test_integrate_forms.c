/* >>integrate: integrators in the second-order and the first-order form: FB_WITH_FORMS. */
#include "integrate.h"

#if FB_WITH_FORMS

/* ---- all integrators */

/* E11.4, E11.5: the implicit integrators advance each form; on a closed basis all arrive at the same place. */
TEST(implicit_integrators_advance_every_form)
{
  fb_state end[3];
  for (int form = 0; form < FBT_FORMS; form++) {
    const double dt = 0.0005;
    fb_input input[3];
    fb_state *state = &end[form];
    strained(FB_BASE_FREE, form, 1e5, 0);
    fbt_seed(5);
    start(state, 0.05, 0.2);
    for (int k = 0; k < 400; k++) {
      for (int i = 0; i < 3; i++) {
        memset(&input[i], 0, sizeof input[i]);
        input[i].n_load = 1;
        input[i].load[0].torque[1] = (fb_real)(10.0 * sin(2.0 * dt * (k + 0.5 * i)));
      }
      FBT_INT_EQ(step(SDIRK, state, &input[0], &input[1], &input[2], dt), FB_OK);
    }
    FBT_BELOW(fbt_difference(state->q, end[0].q, body.n),
              FBT_TOL(form == FBT_FIRST ? 2e-4 : 2e-5, 2e-3)); /* truncation */
  }
}

SUITE(integrate_forms, RUN_FORMS(implicit_integrators_advance_every_form))

#endif
