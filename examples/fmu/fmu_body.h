/* fmu_body.h - a flexible body behind an FMU: what fmu_core.h asks of a plant. Include flexbeam.h, fmu_variables.h and
   the model in ROM first.
   The model is constant. A copy of it takes what varies: gravity, which is an input, and the scale of the damping. Other
   masses, stiffness and effects build it anew from the parts of the description. */
#ifndef FMU_BODY_H
#define FMU_BODY_H
#include "clear.h"
#include "refusal.h"
#include "stepper.h"
#include <math.h>
#include <string.h>

/* Parameters that make the body. */
static const fmu_kind fmu_making[] = {FMU_STIFFNESS, FMU_MASS, FMU_HUB_MASS, FMU_HUB_INERTIA, FMU_EFFECTS, FMU_DAMPING};
enum { FMU_BY_DAMPING = sizeof fmu_making / sizeof *fmu_making - 1, FMU_MAKING };

typedef struct fmu_plant {
  fb_body body;
  fb_input input[3]; /* at the start, the middle and the end of a step */
  fb_stepper stepper;
  fb_exponential exponential;
  fb_body_work work;
  fb_shape shape;            /* scratch */
  double making[FMU_MAKING]; /* that body was made by */
} fmu_plant;

typedef fb_state fmu_plant_state;

static inline void fmu_plant_clear(fmu_plant *p)
{
  clear_memory(p, sizeof *p);
}

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
  return fmu_variables(list, &fmu_model, &fmu_model_parts);
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

static void fmu_times(fb_real *x, double factor, int n)
{
  for (int k = 0; k < n; k++) {
    x[k] *= factor;
  }
}

/* All inertia of a shape by a factor, its stiffness by another. Modes keep their shapes and are normalized anew: their
   displacements go by the inverse root of the factor of the mass, integrals of first degree by the root. */
static void fmu_shape_times(fb_shape *s, double mass, double stiffness)
{
  const double root = sqrt(mass), unit = 1 / root;
  const int n = s->n;
  fmu_times(&s->mass, mass, 1);
  fmu_times(s->c, mass, 3);
  fmu_times(s->J, mass, 9);
  fmu_times(s->P, root, 3 * n);
  fmu_times(s->H, root, 3 * n);
  fmu_times(s->second.Gam, root, 9 * n);
  fmu_times(s->second.reach, unit, n);
  fmu_times(s->K, stiffness / mass, n * n);
  for (int k = 0; k < s->n_node; k++) {
    fmu_times(s->node[k].psi, unit, 3 * n);
    fmu_times(s->node[k].theta, unit, 3 * n);
#if FBI_WITH_QUADRATIC
    fmu_times(s->node[k].chi, 1 / mass, 3 * n * (n + 1) / 2);
    fmu_times(s->node[k].chi_theta, 1 / mass, 3 * n * (n + 1) / 2);
#endif
  }
}

/* The body of other masses, stiffness, effects. */
static fb_status fmu_plant_build(fmu_plant *p, const double *making)
{
  const fmu_parts *const parts = &fmu_model_parts;
  const double hub_mass = parts->hub_mass * making[2];
  const int choice = (int)making[4];
  fb_body_desc desc = parts->desc;
  fb_real inertia[6];
  fb_status status = FB_OK;
  if (choice > 1) {
    desc.effects = fmu_effects[choice - 1] | (desc.effects & (FB_EFFECT_DAMPING | FB_EFFECT_GRAVITY));
  }
  for (int i = 0; i < 6; i++) {
    inertia[i] = parts->hub_inertia[i] * making[3];
  }
  p->shape = parts->rest;
  fmu_shape_times(&p->shape, making[1], making[0]);
  if (hub_mass > 0 || inertia[0] + inertia[1] + inertia[2] > 0) {
    status = fb_shape_add_rigid(&p->shape, hub_mass, parts->hub_center, inertia);
  }
  return status ? status : fb_body_init(&p->body, &p->work, &p->shape, &desc);
}

/* The copy, with its damping. */
static fb_status fmu_plant_make(fmu_plant *p, const double *making)
{
  const double damping = making[FMU_BY_DAMPING];
  fb_status status = FB_OK;
  int as_described = 1;
  for (int k = 0; k < FMU_BY_DAMPING; k++) {
    as_described = as_described && !(making[k] < 1 || making[k] > 1);
  }
  p->body.n_node = 0;     /* none is made */
  p->stepper.desc.dt = 0; /* none is ready */
  if (as_described) {
    p->body = fmu_model;
  } else {
    status = fmu_plant_build(p, making);
  }
  if (status != FB_OK) {
    return status;
  }
  memcpy(p->making, making, sizeof p->making);
#if FB_WITH_DAMPING
  p->body.limit_damping *= damping;
  for (int k = 0; k < p->body.n; k++) {
    p->body.C.diagonal[k] *= damping;
  }
  for (int k = 0; k < p->body.C.n_term; k++) {
    p->body.C.term[k].c *= damping;
  }
#else
  (void)damping;
#endif
  return FB_OK;
}

/* Motion of a prescribed base so long after it was set. */
static void fmu_plant_move(fb_input *in, const fmu_values *v, double after)
{
  const double *const velocity = fmu_of(v, FMU_BASE_VELOCITY, 0), *const rate = fmu_of(v, FMU_BASE_RATE, 0);
  for (int i = 0; velocity && i < 3; i++) {
    in->v_dot[i] = fmu_of(v, FMU_BASE_ACCELERATION, 0)[i];
    in->w_dot[i] = fmu_of(v, FMU_BASE_RATE_DOT, 0)[i];
    in->v[i] = velocity[i] + after * in->v_dot[i];
    in->w[i] = rate[i] + after * in->w_dot[i];
  }
}

/* It goes on for so long: what was set is what is there now. */
static void fmu_plant_moved(fmu_plant *p, const fmu_values *v, double after)
{
  fmu_plant_move(&p->input[0], v, after);
  for (int i = 0; fmu_of(v, FMU_BASE_VELOCITY, 0) && i < 3; i++) {
    fmu_of(v, FMU_BASE_VELOCITY, 0)[i] = p->input[0].v[i];
    fmu_of(v, FMU_BASE_RATE, 0)[i] = p->input[0].w[i];
  }
}

/* Loads as the values have them, and the motion of the base in a step of dt that begins so long after it was set. */
static void fmu_plant_load(fmu_plant *p, const fmu_values *v)
{
  for (int at = 0; at < 3; at++) {
    p->input[at].n_load = p->body.n_node;
    for (int k = 0; k < p->body.n_node; k++) {
      fb_load *const load = &p->input[at].load[k];
      load->node = k;
      load->axes = FB_AXES_BODY;
      memcpy(load->force, fmu_of(v, FMU_FORCE, k), sizeof load->force);
      memcpy(load->torque, fmu_of(v, FMU_TORQUE, k), sizeof load->torque);
    }
    fmu_plant_move(&p->input[at], v, 0);
  }
}

/* Model and loads as the values have them. */
static fb_status fmu_plant_set(fmu_plant *p, const fmu_values *v)
{
  double making[FMU_MAKING];
  int same = p->body.n_node > 0;
  fb_status status = FB_OK;
  for (int k = 0; k < FMU_MAKING; k++) {
    const double *const x = fmu_of(v, fmu_making[k], 0);
    making[k] = x ? *x : 1;
    same = same && !(making[k] < p->making[k] || making[k] > p->making[k]);
  }
  status = same ? FB_OK : fmu_plant_make(p, making);
  if (status != FB_OK) {
    return status;
  }
#if FB_WITH_GRAVITY
  if (fmu_of(v, FMU_GRAVITY, 0)) {
    memcpy(p->body.gravity, fmu_of(v, FMU_GRAVITY, 0), sizeof p->body.gravity);
  }
#endif
  fmu_plant_load(p, v);
  return FB_OK;
}

/* The body of these parameters. */
static fmu_answer fmu_plant_prepare(fmu_plant *p, const fmu_values *v, fmu_text text)
{
  return fmu_plant_said(text, FMU_ERROR, "parameters", fmu_plant_set(p, v));
}

/* The state that the parameters describe. */
static fmu_answer fmu_plant_start(fmu_plant *p, fmu_plant_state *state, const fmu_values *v, fmu_text text)
{
  const double *const velocity = fmu_of(v, FMU_START_VELOCITY, 0), *const q = fmu_of(v, FMU_START_Q, 0);
  const double *const rate = fmu_of(v, FMU_START_RATE, 0);
  fb_real R[9], own[3];
  fb_status status = fmu_plant_set(p, v);
  memcpy(own, p->input[0].v, sizeof own);
  status = status ? status : fb_state_init(&p->body, state);
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
  status =
      status ? status
             : fb_state_from_velocity(&p->body, state, own, rate ? rate : p->input[0].w, fmu_of(v, FMU_START_Q_DOT, 0));
  status = status ? status : fb_state_check(&p->body, state);
  return fmu_plant_said(text, FMU_ERROR, "initialization", status);
}

/* A stepper for steps of dt; as it is if it is one already. */
static fb_status fmu_plant_ready(fmu_plant *p, fmu_plant_state *state, const fmu_values *v, double dt)
{
  const fb_integrator integrator = (fb_integrator)((int)*fmu_of(v, FMU_INTEGRATOR, 0) - 1);
  const int same = !(p->stepper.desc.dt < dt || p->stepper.desc.dt > dt) && p->stepper.desc.integrator == integrator;
  p->stepper.desc.dt = same ? p->stepper.desc.dt : 0;
  return same
             ? FB_OK
             : body_stepper(&p->stepper, &p->exponential, &p->work, &p->body, state, p->input, integrator, (fb_real)dt);
}

/* n steps of dt with inputs held; on failure *done tells how many went well. */
static fb_status fmu_plant_advance(fmu_plant *p, fmu_plant_state *state, int *done, const fmu_values *v, double dt,
                                   int n)
{
  fb_status status = fmu_plant_set(p, v);
  status = status ? status : fmu_plant_ready(p, state, v, dt);
  for (*done = 0; *done < n && status == FB_OK; *done += status == FB_OK) {
    for (int at = 0; at < 3; at++) {
      fmu_plant_move(&p->input[at], v, (*done + 0.5 * at) * dt);
    }
    status = fb_stepper_step(&p->stepper);
  }
  if (status == FB_OK) {
    fmu_plant_moved(p, v, n * dt);
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
  const fmu_answer answer = fmu_plant_prepare(p, v, text);
  (void)state;
  *h = fmin(FMU_INSTANT, (double)fb_rk4_limit(&p->body, FB_R(0.0), FB_R(0.0)) / 400);
  return answer;
}

static fmu_answer fmu_plant_ahead(fmu_plant *p, fmu_plant_state *state, const fmu_values *v, double h, fmu_text text)
{
  fb_input *const in = p->input;
  fb_status status = fmu_plant_set(p, v);
  fmu_plant_move(&in[1], v, 0.5 * h);
  fmu_plant_move(&in[2], v, h);
  status = status ? status : fb_rk4_step(&p->body, state, &p->stepper.work.rk4, &in[0], &in[1], &in[2], (fb_real)h);
  if (status == FB_OK) {
    fmu_plant_moved(p, v, h);
  }
  return fmu_plant_said(text, FMU_ERROR, "derivatives", status);
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
  fb_status status = fmu_plant_set(p, v);
  status = status ? status : fb_body_motion_eval(&p->body, &motion, state, &p->input[0]);
  status = status ? status : fb_body_energy_eval(&p->body, &energy, state, &p->input[0]);
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
