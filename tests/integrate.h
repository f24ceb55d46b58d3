/* integrate.h - the integrators, and booms and strained beams that they step, shared by the tests of >>integrate:
   the integrators, their limits and orders, conservation over long runs, the spin-up. */
#ifndef FBT_INTEGRATE_H
#define FBT_INTEGRATE_H

#include "fbt.h"

static fb_beam_desc beam_desc;
static fb_beam beam;
static fb_modes modes;
static fb_modes_work modes_work;
static fb_shape shape;
static fb_body body;
static fb_body_work body_work;
static fb_body_desc body_desc;
static fb_real mass_unit = FB_R(1.0); /* [kg] of booms */

/* A uniform boom (10 m, 12 kg) along x on a rigid hub with bend_y + bend_z + axial modes; its tip is node 1. */
static inline void boom(unsigned effects, fb_base base, int bend_y, int bend_z, int axial, double zeta)
{
  static const fb_real center[3] = {0};
  const fb_real u = mass_unit, inertia[6] = {FB_R(40.0) * u, FB_R(30.0) * u, FB_R(50.0) * u,
                                             FB_R(2.0) * u,  -FB_R(1.0) * u, FB_R(3.0) * u};
  fb_modes_desc keep;
  int tip;
  memset(&beam_desc, 0, sizeof beam_desc);
  beam_desc.length = FB_R(10.0);
  beam_desc.n_element = 10;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = u * FB_R(1.2);
  beam_desc.station[0].EA = u * FB_R(31724000.0);
  beam_desc.station[0].EI_y = beam_desc.station[0].EI_z = u * FB_R(14004.0);
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Y] = bend_y;
  keep.count[FB_KIND_BEND_Z] = bend_z;
  keep.count[FB_KIND_AXIAL] = axial;
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(20.0) * u, center, inertia), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &tip, 0, &beam, &modes, FB_R(10.0)), FB_OK);
  memset(&body_desc, 0, sizeof body_desc);
  body_desc.effects = effects;
  body_desc.base = base;
  body_desc.allow_split_effects = 1;
  for (int k = 0; k < modes.n; k++) {
    body_desc.zeta[k] = (fb_real)zeta;
  }
  fbt_fit(&body_desc);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &body_desc), FB_OK);
}

static inline void start(fb_state *state, double deflection, double spin)
{
  fb_real v[3], w[3], qd[FB_MAX_MODES] = {0};
  FBT_INT_EQ(fb_state_init(&body, state), FB_OK);
  fbt_fill(state->q, body.n, deflection);
  fbt_fill(v, 3, 0.3);
  fbt_fill(w, 3, spin);
  FBT_INT_EQ(fb_state_from_velocity(&body, state, v, w, qd), FB_OK);
}

static inline double energy_of(const fb_state *state)
{
  fb_energy e;
  FBT_INT_EQ(fb_body_energy_eval(&body, &e, state, NULL), FB_OK);
  return (double)e.kinetic + (double)e.strain + (double)e.gravity;
}

/* ---- all integrators */

typedef fb_integrator integrator;
#define RK4 FB_INTEGRATOR_RK4
#define MIDPOINT FB_INTEGRATOR_MIDPOINT
#define SDIRK FB_INTEGRATOR_SDIRK
#define EXPONENTIAL FB_INTEGRATOR_EXPONENTIAL
#define INTEGRATORS FB_INTEGRATOR_COUNT
static fb_exponential exponential;
static fb_implicit_work implicit_work;
static fb_exponential_work exponential_work;

/* One step of an integrator; the exponential one is prepared for dt. */
static inline fb_status step(integrator which, fb_state *state, const fb_input *in0, const fb_input *in1,
                             const fb_input *in2, double dt)
{
  fb_rk4_work work;
  switch (which) {
  case RK4:
    return fb_rk4_step(&body, state, &work, in0, in1, in2, (fb_real)dt);
  case MIDPOINT:
    return fb_midpoint_step(&body, state, &implicit_work, in1, (fb_real)dt, 0);
  case SDIRK:
    return fb_sdirk_step(&body, state, &implicit_work, in0, in2, (fb_real)dt, 0);
  case EXPONENTIAL:
    return fb_exponential_step(&body, &exponential, state, &exponential_work, in0, in1, in2);
  case INTEGRATORS:
    break;
  }
  return FB_ERR_UNSUPPORTED;
}

static inline void prepare(integrator which, double dt)
{
  if (which == EXPONENTIAL) {
    FBT_INT_EQ(fb_exponential_init(&exponential, &body_work, &body, (fb_real)dt), FB_OK);
    FBT_INT_EQ(fb_exponential_check(&exponential, &body), FB_OK);
  }
}

/* Cubic elements with nonlinear strain, bending in both planes (EI_y > 0) or one. */
static inline void strained_beam(int n_element, double EA, double EI_y, int root_strain)
{
  fb_modes_desc keep;
  int tip;
  memset(&beam_desc, 0, sizeof beam_desc);
  beam_desc.length = FB_R(10.0);
  beam_desc.n_element = n_element;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = FB_R(1.2);
  beam_desc.station[0].EA = (fb_real)EA;
  beam_desc.station[0].EI_y = (fb_real)EI_y;
  beam_desc.station[0].EI_z = FB_R(14004.0);
  memset(&keep, 0, sizeof keep);
  keep.basis = FB_BASIS_FUNCTIONS;
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = keep.count[FB_KIND_AXIAL] = FB_ALL_MODES;
  keep.root_strain = root_strain;
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_strain(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &tip, 0, &beam, &modes, FB_R(10.0)), FB_OK);
}

static fb_form_body formed;
static fb_form_work form_work;

/* The body of shape and body_desc in a form: `formed`, `body` its tables. */
static inline void form_body(int form)
{
  const fb_form_desc kind = {(fb_form)form, FB_TORQUE_IDENTITY, NULL};
  FBT_INT_EQ(fb_form_init(&formed, &body_work, &shape, &body_desc, &kind), FB_OK);
  body = formed.body;
}

static inline fb_status form_step(integrator which, fb_state *state, const fb_input *in0, const fb_input *in1,
                                  const fb_input *in2, double dt, int iterations)
{
  return fb_form_step(&formed, state, &form_work, which, in0, in1, in2, (fb_real)dt, iterations);
}

static inline void strained_body(fb_base base, int form)
{
  memset(&body_desc, 0, sizeof body_desc);
  body_desc.effects = FB_EFFECTS_STRAIN;
  body_desc.base = base;
  form_body(form);
}

/* Two elements in both planes on a hub. */
static inline void strained(fb_base base, int form, double EA, int root_strain)
{
  static const fb_real center[3] = {FB_R(0.1), 0, 0}, inertia[6] = {FB_R(40.0), FB_R(30.0), FB_R(50.0), 0, 0, 0};
  strained_beam(2, EA, 9000.0, root_strain);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(20.0), center, inertia), FB_OK);
  strained_body(base, form);
}

#endif
