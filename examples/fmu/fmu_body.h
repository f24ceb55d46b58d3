/* fmu_body.h - a flexible body behind an FMU: what fmu_core.h asks of a plant. Include flexbeam.h, the model in ROM and
   fmu_variables.h first.
   The model is constant. A copy of it takes what varies: gravity, which is an input, and the scale of the damping. */
#ifndef FMU_BODY_H
#define FMU_BODY_H
#include "clear.h"
#include "refusal.h"
#include <math.h>
#include <string.h>

#define FMU_MOST_STEPS 10000000 /* within a communication step */

typedef struct fmu_plant {
  fb_body body;
  fb_input input;
  fb_stepper stepper;
  fb_exponential exponential;
  fb_body_work work;
  double damping; /* that body has */
} fmu_plant;

typedef fb_state fmu_plant_state;

/* Is the model what was exported? resources: of the FMU, in which there are none. */
static fmu_answer fmu_plant_open(fmu_plant *p, const char *resources, fmu_text text)
{
  (void)p, (void)resources;
  if (fb_body_crc(&fmu_model) != fmu_model_crc || fb_body_check(&fmu_model) != FB_OK) {
    snprintf(text, sizeof(fmu_text), "the model is not what was exported: its check word differs");
    return FMU_ERROR;
  }
  return FMU_OK;
}

static const char *fmu_plant_token(const fmu_plant *p)
{
  (void)p;
  return FMU_TOKEN;
}

static int fmu_plant_variables(const fmu_plant *p, fmu_variable *list)
{
  (void)p;
  return fmu_variables(list, &fmu_model);
}

static double fmu_plant_default(const fmu_variable *v, int element)
{
  return fmu_start(&fmu_model, v, element, FMU_STEP_DEFAULT);
}

static const char *fmu_plant_node(const fmu_variable *v)
{
  return fmu_node_name[v->node];
}

static inline int fmu_plant_spans(const fmu_plant *p, fmu_span *span, fmu_plant_state *state)
{
  const fmu_span whole = {state, sizeof *state};
  (void)p;
  span[0] = whole;
  return 1;
}

/* There is nothing to build. */
static fmu_answer fmu_plant_prepare(fmu_plant *p, const fmu_values *v, fmu_text text)
{
  (void)p, (void)v, (void)text;
  return FMU_OK;
}

/* A status of the library as an answer, with what it tells of the reason. */
static fmu_answer fmu_plant_said(fmu_text text, fmu_answer answer, const char *where, fb_status status)
{
  char detail[REFUSAL_LENGTH];
  refusal_write(detail, status);
  if (status != FB_OK) {
    snprintf(text, sizeof(fmu_text), "%s: %s%s", where, fb_status_string(status), detail);
  }
  return status == FB_OK ? FMU_OK : answer;
}

/* The copy, with its damping. */
static void fmu_plant_make(fmu_plant *p, double damping)
{
  p->body = fmu_model;
  p->damping = damping;
  p->stepper.desc.dt = 0; /* none is ready */
#if FB_WITH_DAMPING
  p->body.limit_damping *= damping;
  for (int k = 0; k < p->body.n; k++) {
    p->body.C.diagonal[k] *= damping;
  }
  for (int k = 0; k < p->body.C.n_term; k++) {
    p->body.C.term[k].c *= damping;
  }
#endif
}

/* Model and loads as the values have them. */
static void fmu_plant_set(fmu_plant *p, const fmu_values *v)
{
  const double *const damping = fmu_of(v, FMU_DAMPING, 0);
  if (p->body.n_node == 0 || (damping && (*damping < p->damping || *damping > p->damping))) {
    fmu_plant_make(p, damping ? *damping : 1.0);
  }
#if FB_WITH_GRAVITY
  if (fmu_of(v, FMU_GRAVITY, 0)) {
    memcpy(p->body.gravity, fmu_of(v, FMU_GRAVITY, 0), sizeof p->body.gravity);
  }
#endif
  p->input.n_load = p->body.n_node;
  for (int k = 0; k < p->body.n_node; k++) {
    fb_load *const load = &p->input.load[k];
    load->node = k;
    load->axes = FB_AXES_BODY;
    memcpy(load->force, fmu_of(v, FMU_FORCE, k), sizeof load->force);
    memcpy(load->torque, fmu_of(v, FMU_TORQUE, k), sizeof load->torque);
  }
}

/* The state that the parameters describe. */
static fmu_answer fmu_plant_start(fmu_plant *p, fmu_plant_state *state, const fmu_values *v, fmu_text text)
{
  const double *const velocity = fmu_of(v, FMU_START_VELOCITY, 0), *const q = fmu_of(v, FMU_START_Q, 0);
  fb_real R[9], own[3] = {0, 0, 0};
  fb_status status;
  fmu_plant_set(p, v);
  status = fb_state_init(&p->body, state);
  if (status == FB_OK) {
    memcpy(state->rho, fmu_of(v, FMU_START_POSITION, 0), sizeof state->rho);
    memcpy(state->quat, fmu_of(v, FMU_START_ATTITUDE, 0), sizeof state->quat);
    status = fb_quat_normalize(state->quat);
  }
  if (status == FB_OK && q) {
    memcpy(state->q, q, (size_t)p->body.n * sizeof *q);
  }
  if (status == FB_OK && velocity) {
    fb_quat_to_mat33(R, state->quat);
    fb_mat33_mulT_vec3(own, R, velocity);
  }
  status = status ? status
                  : fb_state_from_velocity(&p->body, state, own, fmu_of(v, FMU_START_RATE, 0),
                                           fmu_of(v, FMU_START_Q_DOT, 0));
  status = status ? status : fb_state_check(&p->body, state);
  return fmu_plant_said(text, FMU_ERROR, "initialization", status);
}

/* A stepper for steps of dt; as it is if it is one already. */
static fb_status fmu_plant_ready(fmu_plant *p, fmu_plant_state *state, const fmu_values *v, double dt)
{
  const fb_integrator integrator = (fb_integrator)((int)*fmu_of(v, FMU_INTEGRATOR, 0) - 1);
  const fb_stepper_desc way = {.body = &p->body,
                               .state = state,
                               .input = &p->input,
                               .integrator = integrator,
                               .exponential = &p->exponential,
                               .dt = dt};
  const int same = !(p->stepper.desc.dt < dt || p->stepper.desc.dt > dt) && p->stepper.desc.integrator == integrator;
  fb_status status = FB_OK;
  if (!same) {
    p->stepper.desc.dt = 0;
    status =
        integrator == FB_INTEGRATOR_EXPONENTIAL ? fb_exponential_init(&p->exponential, &p->work, &p->body, dt) : FB_OK;
    status = status ? status : fb_stepper_init(&p->stepper, &way);
  }
  return status;
}

/* n steps of dt with inputs held; on failure *done tells how many went well. */
static fb_status fmu_plant_advance(fmu_plant *p, fmu_plant_state *state, int *done, const fmu_values *v, double dt,
                                   int n)
{
  fb_status status;
  fmu_plant_set(p, v);
  status = fmu_plant_ready(p, state, v, dt);
  for (*done = 0; *done < n && status == FB_OK; *done += status == FB_OK) {
    status = fb_stepper_step(&p->stepper);
  }
  return status;
}

/* Steps of a communication step: n of dt. Where it is a multiple of the internal step, but for the rounding of an
   importer's clock, they are that step, bit for bit; else equal parts that are not longer. 0: too many. */
static int fmu_divide(double *dt, double whole, double step)
{
  const double ratio = whole / step, near = floor(ratio + 0.5);
  const int fits = near >= 1 && fabs(ratio - near) <= FMU_SAME * near;
  const double n = fits ? near : ceil(ratio);
  if (!(n <= FMU_MOST_STEPS)) {
    return 0;
  }
  *dt = fits ? step : whole / n;
  return (int)n;
}

/* A communication step; where it fails the state is somewhere in it. */
static fmu_answer fmu_plant_step(fmu_plant *p, fmu_plant_state *state, const fmu_values *v, double from, double length,
                                 fmu_text text)
{
  const double step = *fmu_of(v, FMU_STEP, 0);
  double dt = 0;
  int done = 0;
  const int n = fmu_divide(&dt, length, step);
  fmu_answer answer;
  if (n == 0) {
    snprintf(text, sizeof(fmu_text), "a communication step of %g s takes more than %d steps of %g s", length,
             FMU_MOST_STEPS, step);
    return FMU_ERROR;
  }
  answer = fmu_plant_said(text, FMU_DISCARD, "step", fmu_plant_advance(p, state, &done, v, dt, n));
  if (answer != FMU_OK) {
    const size_t at = strlen(text);
    snprintf(text + at, sizeof(fmu_text) - at, ", in a step of %g s at %.12g s", dt, from + done * dt);
  }
  return answer;
}

static inline double fmu_plant_until(const fmu_plant *p, const fmu_plant_state *state)
{
  (void)p, (void)state;
  return HUGE_VAL;
}

static inline int fmu_plant_is_due(const fmu_plant *p, const fmu_plant_state *state)
{
  (void)p, (void)state;
  return 0;
}

static inline int fmu_plant_has_events(const fmu_plant *p)
{
  (void)p;
  return 0;
}

static inline fmu_answer fmu_plant_happen(fmu_plant *p, fmu_plant_state *state, const fmu_values *v, fmu_text text)
{
  (void)p, (void)state, (void)v, (void)text;
  return FMU_OK;
}

/* A fraction of what rk4 takes: its phase error over a step is beyond the digits. */
static fmu_answer fmu_plant_instant(fmu_plant *p, double *h, const fmu_plant_state *state, const fmu_values *v,
                                    fmu_text text)
{
  (void)state, (void)text;
  fmu_plant_set(p, v);
  *h = fmin(FMU_INSTANT, (double)fb_rk4_limit(&p->body, FB_R(0.0), FB_R(0.0)) / 400);
  return FMU_OK;
}

static fmu_answer fmu_plant_ahead(fmu_plant *p, fmu_plant_state *state, const fmu_values *v, double h, fmu_text text)
{
  fmu_plant_set(p, v);
  return fmu_plant_said(
      text, FMU_ERROR, "derivatives",
      fb_rk4_step(&p->body, state, &p->stepper.work.rk4, &p->input, &p->input, &p->input, (fb_real)h));
}

static void fmu_put(const fmu_values *v, fmu_kind kind, int node, const fb_real *x, int n)
{
  double *const to = fmu_of(v, kind, node);
  if (to) {
    memcpy(to, x, (size_t)n * sizeof *x);
  }
}

/* Outputs of a node; rates in axes of its section, of the hub as the motion has them. */
static fb_status fmu_plant_put_node(const fmu_plant *p, const fmu_plant_state *state, const fb_motion *motion,
                                    const fmu_values *v, int node)
{
  fb_node_motion m;
  fb_real R[9], rate[3], rate_dot[3];
  const fb_status status = fb_body_node_motion_eval(&p->body, &m, state, motion, node);
  if (status != FB_OK) {
    return status;
  }
  fb_quat_to_mat33(R, m.quat);
  fb_mat33_mulT_vec3(rate, R, m.angular_rate);
  fb_mat33_mulT_vec3(rate_dot, R, m.angular_acceleration);
  fmu_put(v, FMU_POSITION, node, m.position, 3);
  fmu_put(v, FMU_ATTITUDE, node, m.quat, 4);
  fmu_put(v, FMU_VELOCITY, node, m.velocity, 3);
  fmu_put(v, FMU_RATE, node, node == 0 ? motion->w : rate, 3);
  fmu_put(v, FMU_ACCELERATION, node, m.acceleration, 3);
  fmu_put(v, FMU_RATE_DOT, node, node == 0 ? motion->w_dot : rate_dot, 3);
  fmu_put(v, FMU_DEFLECTION, node, m.displacement, 3);
  fmu_put(v, FMU_ROTATION, node, m.rotation, 3);
  return FB_OK;
}

/* Outputs from the state under the inputs. */
static fmu_answer fmu_plant_outputs(fmu_plant *p, const fmu_plant_state *state, const fmu_values *v, fmu_text text)
{
  fb_motion motion;
  fb_energy energy;
  fb_status status;
  fmu_plant_set(p, v);
  status = fb_body_motion_eval(&p->body, &motion, state, &p->input);
  status = status ? status : fb_body_energy_eval(&p->body, &energy, state, &p->input);
  for (int node = 0; node < p->body.n_node && status == FB_OK; node++) {
    status = fmu_plant_put_node(p, state, &motion, v, node);
  }
  if (status == FB_OK) {
    fmu_put(v, FMU_REACTION_FORCE, 0, motion.reaction_force, 3);
    fmu_put(v, FMU_REACTION_TORQUE, 0, motion.reaction_torque, 3);
    fmu_put(v, FMU_Q, 0, state->q, p->body.n);
    fmu_put(v, FMU_Q_DOT, 0, motion.q_dot, p->body.n);
    fmu_put(v, FMU_KINETIC, 0, &energy.kinetic, 1);
    fmu_put(v, FMU_STRAIN, 0, &energy.strain, 1);
    fmu_put(v, FMU_POTENTIAL, 0, &energy.gravity, 1);
  }
  return fmu_plant_said(text, FMU_ERROR, "outputs", status);
}
#endif
