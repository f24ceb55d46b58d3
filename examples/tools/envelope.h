/* envelope.h - the most that happens to a body, and a scene made of it that any set of effects, modes, integrator and
   step can run. Include flexbeam.h and model.h first. */
#ifndef ENVELOPE_H
#define ENVELOPE_H
#include "../common/stepper.h"
#include <math.h>
#include <string.h>

#define SCENE_SAMPLES 512
#define SCENE_STEPS 1e6 /* at most between samples, of the body and of its base */

typedef struct scene {
  fb_body_desc level;     /* base, damping, gravity (along the body's axes as it starts) */
  double spin[3];         /* [rad/s] at the start, or what the spin-up of a prescribed base ends with */
  double spin_rate;       /* [rad/s^2] the largest of the spin-up; 0: it spins from the start */
  double acceleration[3]; /* [m/s^2] of O, prescribed base, body axes; driven like the loads */
  int n_load;
  fb_load load[FB_MAX_LOADS];
  double motor[FB_MAX_ROTORS]; /* [N m], driven like the loads */
  double frequency;            /* [rad/s] of the drive; 0: it rises in half the duration and stays, HUGE_VAL: a jump */
  int pulse;                   /* 1: a single (1 - cos) of that frequency, 0: a sine */
  double duration, sample;     /* [s] */
  int n_sample, node;          /* whose displacement is the output */
} scene;

/* Duration of the spin-up [s]. */
static double scene_ramp(const scene *s)
{
  const double spin = sqrt(s->spin[0] * s->spin[0] + s->spin[1] * s->spin[1] + s->spin[2] * s->spin[2]);
  return s->spin_rate > 0 ? 0.5 * model_pi * spin / s->spin_rate : 0;
}

/* Part of the spin at a time, and its rate. */
static double scene_spin(double *rate, const scene *s, double t)
{
  const double ramp = scene_ramp(s);
  *rate = t < ramp ? 0.5 * model_pi / ramp * sin(model_pi * t / ramp) : 0;
  return t < ramp ? 0.5 - 0.5 * cos(model_pi * t / ramp) : 1;
}

/* Part of the loads and of the acceleration at a time. */
static double scene_drive(const scene *s, double t)
{
  if (!(s->frequency > 0)) {
    return t < 0.5 * s->duration ? 0.5 - 0.5 * cos(2 * model_pi * t / s->duration) : 1;
  }
  if (!(s->frequency < HUGE_VAL)) {
    return 1;
  }
  if (s->pulse) {
    return t * s->frequency < 2 * model_pi ? 0.5 - 0.5 * cos(s->frequency * t) : 0;
  }
  return sin(s->frequency * t);
}

typedef struct scene_base { /* velocity of O, body axes, and when */
  double t, v[3];
} scene_base;

/* v_dot = a - w x v: the base has the acceleration that is asked for, whichever way it has turned. */
static void scene_base_rate(double v_dot[3], const scene *s, double t, const double v[3])
{
  const double drive = scene_drive(s, t);
  double rate;
  const double part = scene_spin(&rate, s, t);
  for (int i = 0; i < 3; i++) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    v_dot[i] = drive * s->acceleration[i] - part * (s->spin[j] * v[k] - s->spin[k] * v[j]);
  }
}

/* Steps per second that the base's turning and its drive call for. */
static double scene_base_steps(const scene *s)
{
  const double fastest = fabs(s->spin[0]) + fabs(s->spin[1]) + fabs(s->spin[2]) +
                         (s->frequency < HUGE_VAL ? s->frequency : 0) + 10 / s->duration;
  return fastest / 0.05;
}

/* The base up to a later time. */
static void scene_base_advance(scene_base *base, const scene *s, double to)
{
  const int n = 1 + (int)((to - base->t) * scene_base_steps(s));
  const double h = (to - base->t) / n;
  for (int step = 0; step < n; step++) {
    double rate[4][3], v[3];
    for (int stage = 0; stage < 4; stage++) {
      const double part = stage == 0 ? 0 : stage == 3 ? 1 : 0.5;
      for (int i = 0; i < 3; i++) {
        v[i] = base->v[i] + (stage > 0 ? part * h * rate[stage - 1][i] : 0);
      }
      scene_base_rate(rate[stage], s, base->t + part * h, v);
    }
    for (int i = 0; i < 3; i++) {
      base->v[i] += h / 6 * (rate[0][i] + 2 * rate[1][i] + 2 * rate[2][i] + rate[3][i]);
    }
    base->t += h;
  }
  base->t = to;
}

/* What acts at a time, later than the one before. */
static void scene_input(fb_input *input, scene_base *base, const scene *s, double t)
{
  const double drive = scene_drive(s, t);
  double v_dot[3], rate, part;
  input->n_load = s->n_load;
  for (int k = 0; k < s->n_load; k++) {
    input->load[k] = s->load[k];
    for (int i = 0; i < 3; i++) {
      input->load[k].force[i] *= (fb_real)drive;
      input->load[k].torque[i] *= (fb_real)drive;
    }
  }
  for (int r = 0; r < s->level.n_rotor; r++) {
    input->rotor[r].torque = s->level.rotor[r].given ? FB_R(0.0) : (fb_real)(drive * s->motor[r]);
    input->rotor[r].momentum = (fb_real)model.rotor[r].momentum;
  }
  if (s->level.base != FB_BASE_PRESCRIBED) {
    return;
  }
  scene_base_advance(base, s, t);
  scene_base_rate(v_dot, s, t, base->v);
  part = scene_spin(&rate, s, t);
  for (int i = 0; i < 3; i++) {
    input->v[i] = (fb_real)base->v[i];
    input->v_dot[i] = (fb_real)v_dot[i];
    input->w[i] = (fb_real)(part * s->spin[i]);
    input->w_dot[i] = (fb_real)(rate * s->spin[i]);
  }
}

/* A prescribed base starts with the body at rest in its frame, bent by gravity and spin, unless the drive is a jump;
   other bodies start undeformed, with the spin. */
static fb_status scene_start(fb_state *state, const fb_body *body, const scene *s, const fb_input *input)
{
  static fb_analyse_work work;
  const fb_real still[3] = {0}, spin[3] = {(fb_real)s->spin[0], (fb_real)s->spin[1], (fb_real)s->spin[2]};
  const int held = s->level.base == FB_BASE_PRESCRIBED;
  fb_status status = fb_state_init(body, state);
  if (held && s->frequency < HUGE_VAL && body->n > 0) {
    static fb_body smooth; /* friction of rotors is none of the steady state */
    fb_input steady = *input;
    smooth = *body;
    for (int r = 0; r < body->n_rotor; r++) {
      const double speed = model.rotor[r].text.speed + (double)fb_vec3_dot(body->rotor[r].axis, input->w);
      state->pi[body->n + r] = body->rotor[r].inertia * (fb_real)speed;
      smooth.rotor[r].damping = smooth.rotor[r].friction = steady.rotor[r].torque = FB_R(0.0);
    }
    return status ? status : fb_body_trim(&smooth, state, &work, &steady);
  }
  status = status ? status : fb_state_from_velocity(body, state, still, held ? input->w : spin, NULL);
  for (int r = 0; r < body->n_rotor && status == FB_OK; r++) {
    status = body->rotor[r].given
                 ? FB_OK
                 : fb_state_rotor_set(body, state, r, (fb_real)model.rotor[r].text.speed, FB_R(0.0), input);
  }
  return status;
}

/* Runs a body with `steps` steps between samples; each goes to `note`. FB_ERR_VALUE: more than SCENE_STEPS. */
static fb_status
scene_run(const scene *s, const fb_body *body, fb_integrator integrator, double steps_wanted,
          fb_status (*note)(void *user, const fb_body *body, const fb_state *state, const fb_input *input), void *user)
{
  static fb_stepper by;
  static fb_exponential exponential;
  static fb_body_work work;
  static fb_input at[3];
  fb_state state;
  scene_base base = {0};
  const int steps = (int)fmin(steps_wanted, SCENE_STEPS);
  const double dt = s->sample / steps;
  fb_status status;
  if (!(steps_wanted <= SCENE_STEPS) ||
      (s->level.base == FB_BASE_PRESCRIBED && !(s->sample * scene_base_steps(s) <= SCENE_STEPS))) {
    return FB_ERR_VALUE;
  }
  memset(at, 0, sizeof at);
  scene_input(&at[2], &base, s, 0);
  status = scene_start(&state, body, s, &at[2]);
  status = status ? status : body_stepper(&by, &exponential, &work, body, &state, at, integrator, dt);
  for (int k = 0; k < s->n_sample * steps && status == FB_OK; k++) {
    at[0] = at[2];
    scene_input(&at[1], &base, s, (k + 0.5) * dt);
    scene_input(&at[2], &base, s, (k + 1) * dt);
    status = fb_stepper_step(&by);
    if ((k + 1) % steps == 0) {
      status = status ? status : note(user, body, &state, &at[2]);
    }
  }
  return status;
}

/* Keeps the largest spin and the largest reading of gravity, axis by axis, with their signs. */
static fb_status scene_note_rigid(void *user, const fb_body *body, const fb_state *state, const fb_input *input)
{
  fb_envelope *const e = (fb_envelope *)user;
  fb_motion motion;
  fb_real R[9], felt;
  const fb_status status = fb_body_motion_eval(body, &motion, state, input);
  fb_quat_to_mat33(R, state->quat);
  for (int i = 0; i < 3; i++) {
    felt = FB_R(0.0);
#if FB_WITH_GRAVITY
    for (int j = 0; j < 3; j++) {
      felt -= R[3 * j + i] * body->gravity[j];
    }
#endif
    e->acceleration[i] = FB_FABS(felt) > FB_FABS(e->acceleration[i]) ? felt : e->acceleration[i];
    e->spin[i] = FB_FABS(motion.w[i]) > FB_FABS(e->spin[i]) ? motion.w[i] : e->spin[i];
  }
  for (int r = 0; r < body->n_rotor; r++) {
    fb_real *const most = &e->rotor[r].momentum, now = motion.rotor_momentum[r];
    *most = FB_FABS(now) > FB_FABS(*most) ? now : *most;
  }
  return status;
}

/* The most that happens in the scene, from its drive and the motion of a rigid body. */
static fb_status scene_envelope(fb_envelope *e, const scene *s, const fb_shape *shape)
{
  static fb_body body;
  static fb_body_work work;
  const double spin = sqrt(s->spin[0] * s->spin[0] + s->spin[1] * s->spin[1] + s->spin[2] * s->spin[2]);
  const double ramp = scene_ramp(s);
  const int pulled = (s->level.effects & FB_EFFECT_GRAVITY) != 0;
  double frequency = s->frequency;
  fb_body_desc level = s->level;
  fb_status status;
  level.effects = FB_EFFECTS_RIGID | (level.effects & FB_EFFECT_GRAVITY);
  memset(level.zeta, 0, sizeof level.zeta);
  level.allow_long_step = 1;
  memset(e, 0, sizeof *e);
  status = fb_body_init(&body, &work, shape, &level);
  status = status
               ? status
               : scene_run(s, &body, FB_INTEGRATOR_RK4, 4 + (int)fmin(20 * spin * s->sample, 1e4), scene_note_rigid, e);
  for (int i = 0; i < 3; i++) {
    const fb_real a = (fb_real)s->acceleration[i];
    e->acceleration[i] += e->acceleration[i] * a < FB_R(0.0) ? -a : a;
    e->spin_rate[i] = (fb_real)(ramp > 0 ? s->spin_rate * s->spin[i] / spin : 0);
  }
  for (int r = 0; r < s->level.n_rotor; r++) {
    e->rotor[r].torque = (fb_real)s->motor[r];
  }
  e->n_load = s->n_load;
  memcpy(e->load, s->load, sizeof e->load);
  frequency = ramp > 0 ? fmax(frequency, model_pi / ramp) : frequency;
  frequency = pulled ? fmax(frequency, spin) : frequency; /* gravity turns in the body's axes */
  e->frequency = frequency < HUGE_VAL ? (fb_real)frequency : FB_HUGE;
  e->smooth = s->pulse;
  e->duration = (fb_real)s->duration;
  if (s->frequency > 0 && s->frequency < HUGE_VAL &&
      !(ramp > 0)) { /* a sine has no end; a pulse leaves a held base at rest */
    const int rests = s->level.base == FB_BASE_PRESCRIBED && !(spin > 0) && !pulled;
    e->lasts = s->pulse ? (fb_real)(rests ? 2 * model_pi / s->frequency : 0) : e->duration;
  }
  e->node = s->node;
  return status;
}

typedef struct scene_record { /* the output at every sample */
  const scene *s;
  fb_real *out;
  int n;
} scene_record;

static fb_status scene_note_output(void *user, const fb_body *body, const fb_state *state, const fb_input *input)
{
  static const fb_motion rest; /* displacements want no velocities */
  scene_record *const record = (scene_record *)user;
  fb_node_motion node;
  const fb_status status = fb_body_node_motion_eval(body, &node, state, &rest, record->s->node);
  (void)input;
  memcpy(record->out + 3 * record->n++, node.displacement, sizeof node.displacement);
  return status;
}

/* Displacement of the output's node at the samples, by the body that a piece of advice describes. */
static fb_status scene_simulate(const scene *s, fb_real *out, const fb_shape *shape, const fb_advice *advice)
{
  static fb_shape selected;
  static fb_body body;
  static fb_body_work work;
  const double steps = ceil(s->sample / (double)advice->dt * (1 - 1e-6));
  scene_record record = {s, out, 0};
  fb_body_desc level = s->level;
  fb_status status = fb_shape_select(&selected, shape, advice->coordinate, advice->n);
  for (int k = 0; k < advice->n; k++) {
    level.zeta[k] = s->level.zeta[advice->coordinate[k]];
  }
  level.effects = advice->effects;
  level.allow_long_step = 1;
  status = status ? status : fb_body_init(&body, &work, &selected, &level);
  return status ? status : scene_run(s, &body, advice->integrator, steps, scene_note_output, &record);
}
#endif
