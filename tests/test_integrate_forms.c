/* >>forms: integrators in every form of the equations of motion. */
#include "integrate.h"

static void form_start(fb_state *state, double deflection, double spin)
{
  fb_real v[3], w[3];
  FBT_INT_EQ(fb_state_init(&body, state), FB_OK);
  fbt_fill(state->q, body.n, deflection);
  fbt_fill(v, 3, 0.3);
  fbt_fill(w, 3, spin);
  FBT_INT_EQ(fb_form_state_from_velocity(&formed, state, v, w, NULL), FB_OK);
}

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
    form_start(state, 0.05, 0.2);
    for (int k = 0; k < 400; k++) {
      for (int i = 0; i < 3; i++) {
        memset(&input[i], 0, sizeof input[i]);
        input[i].n_load = 1;
        input[i].load[0].torque[1] = (fb_real)(10.0 * sin(2.0 * dt * (k + 0.5 * i)));
      }
      FBT_INT_EQ(form_step(SDIRK, state, &input[0], &input[1], &input[2], dt, 0), FB_OK);
    }
    FBT_BELOW(fbt_difference(state->q, end[0].q, body.n),
              FBT_TOL(form == FBT_FIRST ? 2e-4 : 2e-5, 2e-3)); /* truncation */
  }
}

/* What moves a given base, with its rates, and loads at two nodes, all along every axis, at time t. */
static void drive_all(fb_input *input, double t)
{
  memset(input, 0, sizeof *input);
  input->n_load = 2;
  input->load[1].node = 1;
  input->load[1].axes = FB_AXES_BODY;
  for (int i = 0; i < 3; i++) {
    const double f = 2.0 + i, phase = 0.7 * i, up = sin(f * t + phase), rate = f * cos(f * t + phase);
    input->v[i] = (fb_real)(3.0 * up);
    input->v_dot[i] = (fb_real)(3.0 * rate);
    input->w[i] = (fb_real)(0.5 * up);
    input->w_dot[i] = (fb_real)(0.5 * rate);
    input->load[0].force[i] = input->load[1].force[i] = (fb_real)(8.0 * rate);
    input->load[0].torque[i] = input->load[1].torque[i] = (fb_real)(8.0 * up);
  }
}

/* E11.8: between two inputs all of them are what they are on the way from one to the other: SDIRK in every form arrives
   where rk4 does, which is given the middle, too, but for the square of the step. */
TEST(inputs_between_two_are_on_the_way)
{
  for (int form = 0; form < FBT_FORMS; form++) {
    double apart[2];
    strained(FB_BASE_PRESCRIBED, form, 1e4, 0);
    for (int run = 0; run < 2; run++) {
      const int steps = 200 << run;
      const double dt = 0.2 / steps;
      fb_state state, fine;
      fb_input in[3];
      drive_all(&in[0], 0.0);
      FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
      FBT_INT_EQ(fb_form_state_from_velocity(&formed, &state, in[0].v, in[0].w, NULL), FB_OK);
      fine = state;
      for (int k = 0; k < steps; k++) {
        for (int i = 0; i < 3; i++) {
          drive_all(&in[i], dt * (k + 0.5 * i));
        }
        FBT_INT_EQ(form_step(SDIRK, &state, &in[0], &in[1], &in[2], dt, 0), FB_OK);
        FBT_INT_EQ(form_step(RK4, &fine, &in[0], &in[1], &in[2], dt, 0), FB_OK);
      }
      apart[run] = fbt_difference(state.q, fine.q, body.n);
    }
    FBT_NEAR_ABS(log2(apart[0] / apart[1]), 2.0, 0.1);
    FBT_BELOW(apart[1], 1e-5);
  }
}

/* E11.4, E11.5: on a base at rest a linear body's step is linear: one iteration leaves nothing, in every form. */
TEST(one_iteration_steps_linear_bodies_of_every_form)
{
  for (int k = 0; k < 2 * FBT_FORMS; k++) {
    fb_state once, often;
    boom(FB_EFFECTS_LINEAR | FB_EFFECT_DAMPING, FB_BASE_PRESCRIBED, 2, 2, 0, 0.02);
    form_body(k % FBT_FORMS);
    fbt_seed(8);
    form_start(&once, 0.05, 0.2);
    often = once;
    for (int n = 1; n <= 10; n += 9) {
      fb_state *const s = n == 1 ? &once : &often;
      FBT_INT_EQ(form_step(k < FBT_FORMS ? MIDPOINT : SDIRK, s, NULL, NULL, NULL, 0.02, n), FB_OK);
    }
    FBT_BELOW(fbt_difference(once.q, often.q, body.n), FBT_TOL(1e-14, 1e-6));
    FBT_BELOW(fbt_difference(once.pi, often.pi, body.n), FBT_TOL(1e-13, 1e-5));
  }
}

/* E11.4, E11.5: small motion of a free body at rest, or a pinned one, is linear: one iteration leaves next to nothing,
   in every form. */
TEST(one_iteration_steps_small_motion_of_every_form)
{
  for (int k = 0; k < 4 * FBT_FORMS; k++) {
    const double size = FBT_TOL(1e-7, 1e-4);
    fb_state once, often;
    boom(FB_EFFECTS_LINEAR | FB_EFFECT_DAMPING, k / (2 * FBT_FORMS) ? FB_BASE_PINNED : FB_BASE_FREE, 2, 2, 0, 0.02);
    form_body(k % FBT_FORMS);
    FBT_INT_EQ(fb_state_init(&body, &once), FB_OK);
    fbt_seed(8);
    fbt_fill(once.q, body.n, size);
    often = once;
    for (int n = 1; n <= 10; n += 9) {
      fb_state *const s = n == 1 ? &once : &often;
      for (int m = 0; m < 3; m++) {
        FBT_INT_EQ(form_step(k / FBT_FORMS % 2 ? MIDPOINT : SDIRK, s, NULL, NULL, NULL, 0.02, n), FB_OK);
      }
    }
    FBT_BELOW(fbt_difference(once.q, often.q, body.n), FBT_TOL(1e-6, 1e-3) * size);
    FBT_BELOW(fbt_difference(once.pi, often.pi, body.n), FBT_TOL(1e-6, 1e-3) * fbt_largest(often.pi, body.n));
    FBT_BELOW(fbt_difference(once.quat, often.quat, 4), FBT_TOL(1e-6, 1e-3) * size);
  }
}

SUITE(integrate_forms, RUN(implicit_integrators_advance_every_form), RUN(inputs_between_two_are_on_the_way),
      RUN(one_iteration_steps_linear_bodies_of_every_form), RUN(one_iteration_steps_small_motion_of_every_form))
