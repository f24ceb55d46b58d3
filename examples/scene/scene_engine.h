/* scene_engine.h - what moves a scene: one body alone, bodies on joints, an exact beam. Each way has the same calls:
   start, step, look. See scene.h. */
#ifndef SCENE_ENGINE_H
#define SCENE_ENGINE_H
#include "scene_time.h"
#include "../common/stepper.h"

typedef struct scene_instant { /* of a step: what a distributed load needs to know beside its points and the time */
  const scene *s;
  double side;
} scene_instant;

struct scene_engine {
  fb_body_work body_work;
  int place[FB_MAX_BODIES][FB_MAX_MODES]; /* in it, of the modes that the file has; -1: left out */
  fb_integrator integrator;
  int long_step;  /* steps beyond the limit are not refused */
  fb_state state; /* one body alone */
  int is_formed;  /* it moves by another form than the momentum form: */
  fb_form_body formed;
  fb_form_work form_work;
  fb_state plain; /* its start in the momentum form */
  fb_input at[3]; /* start, middle, end of the step */
  fb_stepper by;  /* of the body or the bodies on joints */
  fb_exponential exponential;
  double by_step; /* [s] that it is made for; 0: none yet */
  fb_analyse_work analyse;
  fb_system system; /* bodies on joints */
  fb_system_work system_work;
  fb_system_state system_state;
  fb_system_input system_at[3];
  double origin[SCENE_JOINTS][3]; /* of the axes of joints: from where a rate goes on */
  fb_system_analyse_work system_analyse;
  fb_spectrum spectrum;
  scene_instant instant;
  scene_view view;
  double lowest[SCENE_OUTPUTS], highest[SCENE_OUTPUTS],
      command[SCENE_COMMANDS]; /* in a run: outputs, most of commands */
  fb_body body[FB_MAX_BODIES]; /* last: each is built whole, memory of others is not looked at */
};
SCENE_RUNS(struct scene_engine, engine, );

/* Modal coordinates at the start, of the modes that are kept. */
static void scene_start_modes(int k, fb_real *q, fb_real *q_dot, const scene_body *b)
{
  for (int a = 0; a < FB_MAX_MODES; a++) {
    const int at = engine.place[k][a];
    if (at >= 0 && at < engine.body[k].n) {
      q[at] = (fb_real)b->q[a];
      q_dot[at] = (fb_real)b->q_dot[a];
    }
  }
}

/* ---- distributed loads */

/* Adds one of them at a point. x: 0 at the root, 1 at the tip. */
static void scene_distribute(fb_line_point *p, const scene_distributed *d, double f, double x)
{
  fb_real *const to = d->torque ? p->torque : p->force, own[3], turned[3];
  for (int i = 0; i < 3; i++) {
    own[i] = (fb_real)(f * (d->vector[i] + x * (d->end[i] - d->vector[i]))) * p->length;
  }
  fb_mat33_mul_vec3(turned, p->R, own);
  for (int i = 0; i < 3; i++) {
    to[i] += d->follower ? turned[i] : own[i];
  }
}

/* fb_distributed of a scene: user is the scene_instant. */
static fb_status scene_distributed_at(fb_line_point *point, int n, fb_real t, void *user)
{
  const scene_instant *const now = (const scene_instant *)user;
  const scene *const s = now->s;
  for (int k = 0; k < s->n_distributed; k++) {
    const scene_distributed *const d = &s->distributed[k];
    const double f = function_eval(&d->f, &s->tables, (double)t, now->side).value;
    for (int i = 0; i < n; i++) {
      int tip = i;
      while (tip + 1 < n && point[tip + 1].body == point[i].body && point[tip + 1].line == point[i].line) {
        tip++;
      }
      if (point[i].body == d->body) {
        scene_distribute(&point[i], d, f, (double)(point[i].x / point[tip].x));
      }
    }
  }
  return FB_OK;
}

/* The distributed loads of the step that holds `side`; NULL: the scene has none. */
static fb_distributed scene_distributed_from(const scene *s, double side)
{
  engine.instant.s = s;
  engine.instant.side = side;
  return s->n_distributed > 0 ? scene_distributed_at : NULL;
}

/* What is commanded of a rotor or spring, by the last act that drives it. */
static double scene_commanded(const scene *s, int act)
{
  double sum = 0;
  for (; act >= 0; act = s->act[act].next) {
    sum += remembered[act];
  }
  return sum;
}

/* What drives a rotor. */
static fb_rotor_input scene_rotor_at(const scene *s, const scene_rotor *rotor, double t, double side)
{
  const function_value f = function_eval(&rotor->f, &s->tables, t, side);
  const int given = s->body[rotor->body].level.rotor[rotor->at].given;
  const double command = scene_commanded(s, rotor->act);
  const fb_rotor_input input = {(fb_real)(given ? f.rate : f.value + command), (fb_real)(given ? f.value : 0)};
  return input;
}

/* ---- one body alone */

static void single_input(const scene *s, fb_input *input, double t, double side)
{
  memset(input->v, 0, sizeof *input - offsetof(fb_input, v)); /* behind the loads */
  input->t = (fb_real)t;
  input->distributed = scene_distributed_from(s, side);
  input->user = &engine.instant;
  input->n_load = s->n_load;
  for (int k = 0; k < s->n_load; k++) {
    input->load[k] = scene_load_at(s, &s->load[k], t, side);
  }
  for (int k = 0; k < s->n_motion; k++) {
    const scene_motion *const m = &s->motion[k];
    const function_value f = function_eval(&m->f, &s->tables, t, side);
    for (int i = 0; i < 3; i++) {
      (m->rate ? input->w : input->v)[i] += (fb_real)(f.value * m->vector[i]);
      (m->rate ? input->w_dot : input->v_dot)[i] += (fb_real)(f.rate * m->vector[i]);
    }
  }
  for (int k = 0; k < s->n_rotor; k++) {
    input->rotor[k] = scene_rotor_at(s, &s->rotor[k], t, side);
  }
}

/* Speeds of the rotors at the start; momenta that are given are in the input. */
static fb_status single_start_rotors(const scene *s)
{
  fb_status status = FB_OK;
  for (int k = 0; k < s->n_rotor && status == FB_OK; k++) {
    if (!s->body[0].level.rotor[k].given) {
      status = fb_state_rotor_set(&engine.body[0], &engine.state, k, (fb_real)s->rotor[k].text.speed, 0, &engine.at[0]);
    }
  }
  return status;
}

/* The start in another form: those velocities, or the steady state of the momentum form, which is there. */
static fb_status single_form(const scene *s, const fb_real v[3], const fb_real w[3], const fb_real *q_dot)
{
  fb_motion motion;
  fb_status status;
  engine.plain = engine.state;
  if (!s->trim) {
    return fb_form_state_from_velocity(&engine.formed, &engine.state, v, w, q_dot);
  }
  status = fb_body_motion_eval(&engine.body[0], &motion, &engine.plain, &engine.at[0]);
  return status ? status : fb_form_state_from_velocity(&engine.formed, &engine.state, motion.v, motion.w, NULL);
}

/* Pose, velocities and modal deflection at the start, or the steady state. */
static fb_status single_start(const scene *s)
{
  const scene_body *const b = &s->body[0];
  const int held = b->level.base == FB_BASE_PRESCRIBED;
  fb_real v[3], w[3], q_dot[FB_MAX_MODES];
  fb_state *const x = &engine.state;
  fb_input *const input = &engine.at[0];
  fb_status status = fb_state_init(&engine.body[0], x);
  single_input(s, input, 0, 0);
  scene_reals(x->rho, b->position, 3);
  scene_reals(x->quat, b->attitude, 4);
  scene_reals(v, b->velocity, 3);
  scene_reals(w, b->spin, 3);
  scene_start_modes(0, x->q, q_dot, b);
  status = status ? status : fb_quat_normalize(x->quat);
  if (s->trim) {
    if (!held) {
      memcpy(input->w, w, sizeof w);
    }
  }
  for (int k = 0; k < s->n_rotor; k++) {
    x->pi[engine.body[0].n + k] = input->rotor[k].momentum;
  }
  if (!s->trim || s->n_rotor > 0) {
    status =
        status ? status : fb_state_from_velocity(&engine.body[0], x, held ? input->v : v, held ? input->w : w, q_dot);
  }
  status = status ? status : single_start_rotors(s);
  if (status == FB_OK && s->trim) {
    status = fb_body_trim(&engine.body[0], x, &engine.analyse, input);
  }
  return status == FB_OK && engine.is_formed ? single_form(s, held ? input->v : v, held ? input->w : w, q_dot) : status;
}

static fb_status single_step(const scene *s, double t, double dt)
{
  fb_input *const at = engine.at;
  if (dt != engine.by_step && !engine.is_formed) {
    const fb_status status = body_stepper(&engine.by, &engine.exponential, &engine.body_work, &engine.body[0],
                                          &engine.state, at, engine.integrator, dt);
    if (status != FB_OK) {
      return status;
    }
    engine.by_step = dt;
  }
  single_input(s, &at[0], t, t + 0.5 * dt);
  single_input(s, &at[1], t + 0.5 * dt, t + 0.5 * dt);
  single_input(s, &at[2], t + dt, t + 0.5 * dt);
  return engine.is_formed ? fb_form_step(&engine.formed, &engine.state, &engine.form_work, engine.integrator, &at[0],
                                         &at[1], &at[2], (fb_real)dt, 0)
                          : fb_stepper_step(&engine.by);
}

static fb_status single_look(const scene *s, double t)
{
  scene_view *const view = &engine.view;
  const fb_body *const body = &engine.body[0];
  fb_status status;
  single_input(s, &engine.at[0], t, t + timing.slack);
  view->motion.pose[0] = engine.state;
  if (engine.is_formed) {
    status = fb_form_motion_eval(&engine.formed, &view->motion.motion[0], &engine.state, &engine.at[0]);
    status = status ? status : fb_form_energy_eval(&engine.formed, &view->energy, &engine.state, &engine.at[0]);
    return status ? status : fb_form_momentum_eval(&engine.formed, &view->momentum, &engine.state, &engine.at[0]);
  }
  status = fb_body_motion_eval(body, &view->motion.motion[0], &engine.state, &engine.at[0]);
  status = status ? status : fb_body_energy_eval(body, &view->energy, &engine.state, &engine.at[0]);
  return status ? status : fb_body_momentum_eval(body, &view->momentum, &engine.state, &engine.at[0]);
}

/* ---- bodies on joints */

/* Adds what drives an axis of a joint of so many. */
static void system_drive_add(fb_drive *drive, const scene_drive *d, int axes, const function_tables *tables, double t,
                             double side)
{
  const function_value f = function_eval(&d->f, tables, t, side);
  if (d->kind == SCENE_MOTOR) {
    drive->torque[d->axis] += (fb_real)(d->act < 0 ? f.value : remembered[d->act]);
  } else if (d->kind == SCENE_VALUE) {
    drive->value[d->axis] += (fb_real)f.value;
    drive->rate[d->axis] += (fb_real)f.rate;
    drive->acceleration[d->axis] += (fb_real)f.acceleration;
  } else {
    drive->rate[d->axis] += (fb_real)f.value;
    drive->acceleration[d->axis] += (fb_real)f.rate;
    if (axes < 3) {
      drive->value[d->axis] += (fb_real)f.sum;
    }
  }
}

/* input: of zeros, or from here. What the scene has is written, no more: it has room for much. */
static void system_input(const scene *s, fb_system_input *input, double t, double side)
{
  memset(input->drive, 0, (size_t)(s->n_body + s->n_loop) * sizeof input->drive[0]);
  memset(input->rotor, 0, (size_t)s->n_body * sizeof input->rotor[0]);
  input->t = (fb_real)t;
  input->distributed = scene_distributed_from(s, side);
  input->user = &engine.instant;
  input->n_load = s->n_load;
  for (int k = 0; k < s->n_load; k++) {
    input->load[k].body = s->load[k].body;
    input->load[k].load = scene_load_at(s, &s->load[k], t, side);
  }
  for (int k = 0; k < s->n_joint; k++) {
    for (int i = 0; i < 3 && scene_axes(&s->joint[k]) < 3; i++) {
      input->drive[s->joint[k].at].value[i] = (fb_real)engine.origin[k][i];
    }
  }
  for (int k = 0; k < s->n_drive; k++) {
    const scene_drive *const d = &s->drive[k];
    const scene_joint *const joint = &s->joint[d->joint];
    system_drive_add(&input->drive[joint->at], d, scene_axes(joint), &s->tables, t, side);
  }
  for (int k = 0; k < s->n_spring; k++) {
    const scene_spring *const spring = &s->spring[k];
    input->pull[k] = spring->pulls ? (fb_real)function_eval(&spring->pull, &s->tables, t, side).value : FB_R(0.0);
    input->pull[k] += (fb_real)scene_commanded(s, spring->act);
  }
  for (int k = 0; k < s->n_rotor; k++) {
    input->rotor[s->rotor[k].body][s->rotor[k].at] = scene_rotor_at(s, &s->rotor[k], t, side);
  }
}

/* A body without a joint is free. */
static fb_status system_init(const scene *s)
{
  static fb_system_desc desc;
  memset(&desc, 0, sizeof desc);
  desc.n_body = s->n_body;
  desc.n_loop = s->n_loop;
  desc.n_spring = s->n_spring;
  desc.method = s->method;
  desc.allow_long_step = engine.long_step;
  for (int k = 0; k < s->n_body; k++) {
    desc.model[k] = k;
    desc.joint[k].parent = FB_GROUND;
  }
  for (int k = 0; k < s->n_joint; k++) {
    const scene_joint *const joint = &s->joint[k];
    *(joint->loop ? &desc.loop[joint->at - s->n_body] : &desc.joint[joint->at]) = joint->desc;
  }
  for (int k = 0; k < s->n_spring; k++) {
    desc.spring[k] = s->spring[k].desc;
  }
  return fb_system_init(&engine.system, &engine.system_work, engine.body, &desc, s->n_body);
}

/* Turn and spin of a body on a spherical joint: from the body's axes to the joint's. */
static void system_start_ball(fb_link_motion *start, const fb_real joint_axes[4], const scene_body *b)
{
  const fb_real back[4] = {joint_axes[0], -joint_axes[1], -joint_axes[2], -joint_axes[3]};
  fb_real spin[3], R[9], turn[4], half[4];
  scene_reals(turn, b->attitude, 4);
  scene_reals(spin, b->spin, 3);
  fb_quat_mul(half, back, turn);
  fb_quat_mul(start->quat, half, joint_axes);
  fb_quat_to_mat33(R, joint_axes);
  fb_mat33_mulT_vec3(start->speed, R, spin);
}

static fb_status system_start(const scene *s)
{
  static fb_link_motion start[FB_MAX_BODIES];
  fb_system_input *const input = &engine.system_at[0];
  fb_status status = system_init(s);
  memset(start, 0, sizeof start);
  for (int k = 0; k < s->n_body; k++) {
    const scene_body *const b = &s->body[k];
    scene_reals(start[k].quat, b->attitude, 4);
    scene_start_modes(k, start[k].q, start[k].q_dot, b);
    if (engine.system.joint[k].kind == FB_JOINT_FREE) {
      scene_reals(start[k].value, b->position, 3);
      scene_reals(start[k].speed, b->velocity, 3);
      scene_reals(start[k].speed + 3, b->spin, 3);
    } else if (engine.system.joint[k].kind == FB_JOINT_SPHERICAL) {
      system_start_ball(&start[k], scene_joint_under(s, k)->desc.child_attitude, b);
    }
  }
  for (int k = 0; k < s->n_joint; k++) {
    const scene_joint *const joint = &s->joint[k];
    memcpy(engine.origin[k], joint->start, sizeof engine.origin[k]);
    if (!joint->loop && scene_axes(joint) < 3) {
      scene_reals(start[joint->at].value, joint->start, 3);
      scene_reals(start[joint->at].speed, joint->speed, 3);
    }
  }
  for (int k = 0; k < s->n_rotor; k++) {
    start[s->rotor[k].body].rotor_speed[s->rotor[k].at] = (fb_real)s->rotor[k].text.speed;
  }
  system_input(s, input, 0, 0);
  for (int k = 0; k < s->n_body && s->trim; k++) { /* what the steady state spins about */
    const fb_joint *const joint = &engine.system.joint[k];
    if (joint->kind == FB_JOINT_FREE && joint->mode[0] == FB_AXIS_FREE) {
      scene_reals(input->drive[k].rate + 3, s->body[k].spin, 3);
    }
  }
  status = status ? status
                  : fb_system_state_init(&engine.system, engine.body, &engine.system_state, &engine.system_work, start,
                                         input);
  if (s->trim) {
    return status ? status
                  : fb_system_trim(&engine.system, engine.body, &engine.system_state, &engine.system_analyse, input);
  }
  return status;
}

static fb_status system_step(const scene *s, double t, double dt)
{
  fb_system_input *const at = engine.system_at;
  if (dt != engine.by_step) {
    const fb_stepper_desc way = {.body = engine.body,
                                 .system = &engine.system,
                                 .system_state = &engine.system_state,
                                 .system_work = &engine.system_work,
                                 .system_input = at,
                                 .n_input = 3,
                                 .integrator = engine.integrator,
                                 .dt = (fb_real)dt};
    const fb_status status = fb_stepper_init(&engine.by, &way);
    if (status != FB_OK) {
      return status;
    }
    engine.by_step = dt;
  }
  system_input(s, &at[0], t, t + 0.5 * dt);
  system_input(s, &at[1], t + 0.5 * dt, t + 0.5 * dt);
  system_input(s, &at[2], t + dt, t + 0.5 * dt);
  return fb_stepper_step(&engine.by);
}

/* A rate that takes an axis over goes on from where it is; a value has to be there, whole turns aside. */
static fb_status system_take_over(const scene *s, const scene_event *e, double t)
{
  const scene_joint *const joint = &s->joint[e->joint];
  const fb_real *const value = &engine.view.motion.joint[joint->at].value[e->axis];
  fb_system_input *const input = &engine.system_at[0];
  double ahead;
  fb_status status;
  if (e->mode != FB_AXIS_PRESCRIBED || scene_axes(joint) > 2) {
    return FB_OK;
  }
  status = fb_system_motion_eval(&engine.system, engine.body, &engine.system_work, &engine.view.motion,
                                 &engine.system_state, input);
  ahead = (double)(*value - input->drive[joint->at].value[e->axis]);
  if (status == FB_OK && !scene_has_drive(s, e->joint, e->axis, SCENE_VALUE)) {
    engine.origin[e->joint][e->axis] += ahead;
    system_input(s, input, t, t + timing.slack);
  } else if (status == FB_OK) {
    ahead = scene_axis_slides(joint, e->axis) ? ahead : remainder(ahead, 2 * function_pi);
    engine.system_work.joint = joint->at;
    status = fabs(ahead) <= 1e-6 * (1 + fabs((double)*value)) ? FB_OK : FB_ERR_CONTRADICTION;
  }
  return status;
}

/* Events up to t, a step ends at each. */
static fb_status system_events(const scene *s, int *next, double t)
{
  fb_status status = FB_OK;
  for (; *next < s->n_event && s->event[*next].t <= t + timing.slack && status == FB_OK; (*next)++) {
    const scene_event *const e = &s->event[*next];
    system_input(s, &engine.system_at[0], t, t + timing.slack);
    status = system_take_over(s, e, t);
    status = status ? status
                    : fb_system_axis_set(&engine.system, engine.body, &engine.system_state, &engine.system_work,
                                         s->joint[e->joint].at, e->axis, e->mode, &engine.system_at[0]);
  }
  return status;
}

static fb_status system_look(const scene *s, double t)
{
  scene_view *const view = &engine.view;
  fb_system_input *const input = &engine.system_at[0];
  fb_status status;
  system_input(s, input, t, t + timing.slack);
  status = fb_system_motion_eval(&engine.system, engine.body, &engine.system_work, &view->motion, &engine.system_state,
                                 input);
  status = status ? status
                  : fb_system_energy_eval(&engine.system, engine.body, &engine.system_work, &view->energy,
                                          &engine.system_state, input);
  return status ? status
                : fb_system_momentum_eval(&engine.system, engine.body, &engine.system_work, &view->momentum,
                                          &engine.system_state, input);
}

/* ---- any of the three */

static fb_status scene_start(const scene *s)
{
  memset(controlling, 0, SCENE_CONTROLS * sizeof controlling[0]);
  memset(remembered, 0, (size_t)s->n_remembered * sizeof remembered[0]);
  return s->is_exact ? exact_start(s) : scene_is_system(s) ? system_start(s) : single_start(s);
}

static fb_status scene_step(const scene *s, double t, double dt)
{
  return s->is_exact ? exact_step(s, t, dt) : scene_is_system(s) ? system_step(s, t, dt) : single_step(s, t, dt);
}

static fb_status scene_look(const scene *s, double t)
{
  return s->is_exact ? exact_look(&engine.view) : scene_is_system(s) ? system_look(s, t) : single_look(s, t);
}

/* By scene_run.h. */
static double scene_value(const scene *s, const scene_output *o);

/* ---- controllers */

enum { ORDER_TIME, ORDER_COMMAND, ORDER_VALUE, ORDER_SIZE };

/* Order i of those that are under way. */
static double *control_order_at(const scene_control *d, const struct scene_controlling *c, int i)
{
  return remembered + d->orders + ORDER_SIZE * ((c->first + i) % d->room);
}

/* Orders of a controller that are due: of each command the last one acts. */
static void control_obey(const scene_control *d, struct scene_controlling *c, double t)
{
  for (; c->n > 0 && control_order_at(d, c, 0)[ORDER_TIME] <= t + timing.slack; c->n--) {
    const double *const order = control_order_at(d, c, 0);
    remembered[d->acting + (int)order[ORDER_COMMAND]] = order[ORDER_VALUE];
    c->first = (c->first + 1) % d->room;
  }
}

/* One more order, in the order of time. */
static void control_order(const scene_control *d, struct scene_controlling *c, double t, int command, double value)
{
  const double order[ORDER_SIZE] = {t, command, value};
  int i = c->n++;
  for (; i > 0 && control_order_at(d, c, i - 1)[ORDER_TIME] > t; i--) {
    memcpy(control_order_at(d, c, i), control_order_at(d, c, i - 1), sizeof order);
  }
  memcpy(control_order_at(d, c, i), order, sizeof order);
}

/* Values of the references at t, of turns and their rates: those of a shaper are sums of what they were. */
static void control_references(const scene *s, const scene_control *d, const struct scene_controlling *c, double t,
                               double *r)
{
  const int turns = d->attitude.is, n = turns ? 2 * d->attitude.n_turn : d->n_signal;
  const double *const shape = s->numbers.x + d->shape_first;
  double *const ring = remembered + d->references;
  for (int k = 0; k < (turns ? d->attitude.n_turn : n); k++) {
    const function_value f =
        function_eval(turns ? &d->attitude.turn[k].f : &d->reference[k], &s->tables, t, t + timing.slack);
    r[turns ? 2 * k : k] = f.value;
    if (turns) {
      r[2 * k + 1] = f.rate;
    }
  }
  for (int k = 0; k < n && d->n_shape > 0; k++) {
    double sum = 0;
    for (int i = 0; i < d->shape_length && c->sampled == 0; i++) {
      ring[n * i + k] = turns && k % 2 ? 0 : r[k]; /* as it was before the start */
    }
    ring[n * (c->sampled % d->shape_length) + k] = r[k];
    for (int i = 0; i < d->n_shape; i++) {
      const long at = c->sampled + d->shape_length - (long)shape[2 * i];
      sum += shape[2 * i + 1] * ring[n * (at % d->shape_length) + k];
    }
    r[k] = sum;
  }
}

/* The attitude of a body, as its node shows it: without that of the node in the body that is not deformed. */
static fb_status control_attitude_at(fb_real quat[4], fb_node_motion *node, int body, int at)
{
  const fb_status status = fb_body_node_motion_eval(&engine.body[body], node, &engine.view.motion.pose[body],
                                                    &engine.view.motion.motion[body], at);
  fb_real bent[4];
  fb_quat_from_rotvec(bent, node->rotation);
  fb_quat_mul(quat, engine.view.motion.pose[body].quat, bent);
  return status;
}

/* The attitude that is wanted, and its rate in own axes, by the turns and their rates. */
static void control_wanted(const scene_attitude *a, const double *r, fb_real quat[4], fb_real rate[3])
{
  scene_reals(quat, a->wanted, 4);
  rate[0] = rate[1] = rate[2] = 0;
  for (int k = 0; k < a->n_turn; k++) {
    fb_real turn[3], by[4], R[9], was[4], before[3];
    for (int i = 0; i < 3; i++) {
      turn[i] = (fb_real)(r[2 * k] * a->turn[k].axis[i]);
    }
    fb_quat_from_rotvec(by, turn);
    fb_quat_to_mat33(R, by);
    memcpy(was, quat, sizeof was);
    memcpy(before, rate, sizeof before);
    fb_quat_mul(quat, was, by);
    fb_mat33_mulT_vec3(rate, R, before);
    for (int i = 0; i < 3; i++) {
      rate[i] += (fb_real)(r[2 * k + 1] * a->turn[k].axis[i]);
    }
  }
}

/* The gyro, and what turns inertial axes to its own ones, and those from its body to the body of attitude. */
static fb_status control_gyro_at(fb_real G[9], fb_node_motion *node, const scene_attitude *a)
{
  const fb_real *const q = engine.view.motion.pose[a->body].quat;
  const fb_real back[4] = {q[0], -q[1], -q[2], -q[3]};
  fb_real gyro[4], between[4], off[4];
  const fb_status status = control_attitude_at(gyro, node, a->gyro_body, a->gyro_node);
  const fb_real own[4] = {gyro[0], -gyro[1], -gyro[2], -gyro[3]};
  fb_quat_mul(between, back, engine.view.motion.pose[a->gyro_body].quat);
  fb_quat_mul(off, between, own);
  fb_quat_to_mat33(G, off);
  return status;
}

/* Errors of attitude and rate, axes of the body: e = 2 vec(q^-1 q_wanted), by the shorter way, r = R w_wanted - w. */
static fb_status control_see_attitude(const scene_attitude *a, const double *references, double v[6])
{
  fb_node_motion node;
  fb_real q[4], wanted[4], off[4], rate[3], R[9], own[3], seen[3];
  fb_status status = control_attitude_at(q, &node, a->body, a->node);
  const fb_real inverse[4] = {q[0], -q[1], -q[2], -q[3]};
  control_wanted(a, references, wanted, rate);
  fb_quat_mul(off, inverse, wanted);
  fb_quat_to_mat33(R, off);
  fb_mat33_mul_vec3(own, R, rate);
  status = status ? status : control_gyro_at(R, &node, a);
  fb_mat33_mul_vec3(seen, R, node.angular_rate);
  for (int i = 0; i < 3; i++) {
    v[i] = (off[0] < 0 ? -2 : 2) * (double)off[i + 1];
    v[i + 3] = (double)(own[i] - seen[i]);
  }
  return status;
}

/* What a controller makes of what its sensors say at t. */
static fb_status control_sample(const scene *s, const scene_control *d, struct scene_controlling *c, double t)
{
  const double at = (double)c->sampled * d->sample + d->delay;
  const int limited = remembered[s->n_act + d->allocation] < 1 && c->sampled > 0;
  double v[CONTROL_SIGNALS], width[CONTROL_SIGNALS];
  fb_status status = FB_OK;
  control_references(s, d, c, t, v);
  if (d->attitude.is) {
    const double references[2 * SCENE_TURNS] = {v[0], v[1], v[2], v[3], v[4], v[5]};
    status = control_see_attitude(&d->attitude, references, v);
  }
  for (int i = 0; i < d->n_sensor; i++) {
    const double seen = control_round(scene_value(s, &s->output[d->sensor[i].output]), d->sensor[i].step);
    for (int k = 0; k < d->n_signal; k++) {
      v[k] -= d->sensor[i].gain[k] * seen;
    }
  }
  control_step(d->block, &s->numbers, &s->tables, remembered + d->memory, d->n_block, v, d->sample, c->sampled == 0,
               limited, width);
  for (int k = 0; k < d->n_command; k++) {
    control_order(d, c, at, k, v[k]);
    if (width[k] < d->sample) {
      control_order(d, c, at + width[k], k, 0);
    }
  }
  c->sampled++;
  return status;
}

/* What an act of an allocation is to do by these commands; one that pushes one way alone leaves the other to others. */
static double scene_demand(const scene_act *act, const double *command, int n)
{
  double sum = 0;
  for (int k = 0; k < n; k++) {
    sum += act->gain[k] * command[k];
  }
  return (!(fabs(act->low) > 0) && sum < 0) || (!(fabs(act->high) > 0) && sum > 0) ? 0 : sum;
}

/* Commands of all controllers to the actuators of an allocation. Where a limit is passed, all are reduced by one factor: the
   direction of what they do is kept, and a body does not turn about an axis that nobody asked for. */
static void scene_allocate(const scene *s, int at)
{
  const scene_allocation *const a = &s->allocation[at];
  double command[CONTROL_SIGNALS] = {0}, factor = 1;
  for (int k = 0; k < s->n_control; k++) {
    const scene_control *const c = &s->control[k];
    for (int i = 0; i < c->n_command && c->allocation == at; i++) {
      command[c->to + i] += remembered[c->acting + i];
    }
  }
  for (int k = a->first; k < a->first + a->n_act; k++) {
    const scene_act *const act = &s->act[k];
    const double demand = scene_demand(act, command, a->n), most = demand < 0 ? act->low : act->high;
    remembered[k] = demand;
    factor = fabs(demand) * factor > fabs(most) ? most / demand : factor;
  }
  for (int k = a->first; k < a->first + a->n_act && factor < 1; k++) {
    remembered[k] *= factor;
  }
  remembered[s->n_act + at] = factor;
}

/* Controllers whose instant has come see the state before it, and the commands that acted before; then what is due
   acts. */
static fb_status scene_control_act(const scene *s, double t)
{
  int looked = 0;
  for (int k = 0; k < s->n_control; k++) {
    const scene_control *const d = &s->control[k];
    while ((double)controlling[k].sampled * d->sample <= t + timing.slack) {
      fb_status status = looked++ ? FB_OK : scene_look(s, t);
      status = status ? status : control_sample(s, d, &controlling[k], t);
      if (status != FB_OK) {
        return status;
      }
    }
  }
  for (int k = 0; k < s->n_control; k++) {
    control_obey(&s->control[k], &controlling[k], t);
  }
  for (int k = 0; k < s->n_allocation; k++) {
    scene_allocate(s, k);
  }
  return FB_OK;
}

/* What happens at t before the step that begins there: samples, then events. */
static fb_status scene_happen(const scene *s, int *event, double t)
{
  const fb_status status = scene_control_act(s, t);
  return status ? status : system_events(s, event, t);
}

/* fall[b]: the ground does not hold body b, not through any joint or loop. */
static void scene_falling(int *fall, const scene *s)
{
  const fb_system *const system = &engine.system;
  const int n_joint = scene_is_system(s) ? system->n_body + system->n_loop : 0;
  for (int b = 0; b < s->n_body; b++) {
    fall[b] = scene_is_system(s) || s->body[b].level.base == FB_BASE_FREE;
  }
  for (int sweep = 0; sweep < s->n_body; sweep++) {
    for (int j = 0; j < n_joint; j++) {
      const fb_joint *const joint = &system->joint[j];
      const int free = joint->kind == FB_JOINT_FREE && engine.system_state.mode[j][0] == FB_AXIS_FREE && !joint->moored;
      int *const child = &fall[j < system->n_body ? j : joint->child];
      int *const parent = joint->parent == FB_GROUND ? NULL : &fall[joint->parent];
      *child = *child && (free || (parent && *parent));
      if (parent) {
        *parent = *parent && *child;
      }
    }
    for (int j = 0; j < s->n_spring; j++) {
      const int *const body = s->spring[j].desc.body;
      const int falls = body[0] >= 0 && body[1] >= 0 && fall[body[0]] && fall[body[1]];
      for (int side = 0; side < 2; side++) {
        if (body[side] >= 0) {
          fall[body[side]] = falls;
        }
      }
    }
  }
}

/* Points of a spring, inertial axes, in the motion of the view. */
static fb_status scene_spring_points(fb_real x[2][3], const scene *s, int k)
{
  const fb_spring *const spring = &s->spring[k].desc;
  fb_status status = FB_OK;
  for (int side = 0; side < 2 && status == FB_OK; side++) {
    const int b = spring->body[side];
    memcpy(x[side], spring->position[side], sizeof x[side]);
    if (b >= 0) {
      fb_node_motion at;
      fb_real R[9];
      status = fb_body_node_motion_eval(&engine.body[b], &at, &engine.view.motion.pose[b],
                                        &engine.view.motion.motion[b], spring->node[side]);
      fb_quat_to_mat33(R, at.quat);
      fb_mat33_mul_vec3(x[side], R, spring->position[side]);
      for (int i = 0; i < 3; i++) {
        x[side][i] += at.position[i];
      }
    }
  }
  return status;
}

/* What falls, falls as it would without weight: the modes of its rigid motion are zeros then, and not what rounding
   makes of falling where it leans to. weight: to be put back. */
static void scene_drop_weight(const scene *s, fb_real weight[FB_MAX_BODIES][3])
{
  int fall[FB_MAX_BODIES];
  scene_falling(fall, s);
  for (int b = 0; b < s->n_body; b++) {
    memcpy(weight[b], engine.body[b].gravity, sizeof weight[b]);
    for (int i = 0; i < 3 && fall[b]; i++) {
      engine.body[b].gravity[i] = 0;
    }
  }
}

static void scene_put_weight(const scene *s, fb_real weight[FB_MAX_BODIES][3])
{
  for (int b = 0; b < s->n_body; b++) {
    memcpy(engine.body[b].gravity, weight[b], sizeof weight[b]);
  }
}

/* Modes about the present state. */
static fb_status scene_spectrum(const scene *s)
{
  fb_real weight[FB_MAX_BODIES][3];
  fb_status status;
  scene_drop_weight(s, weight);
  if (scene_is_system(s)) {
    system_input(s, &engine.system_at[0], 0, 0);
    status = fb_system_spectrum_solve(&engine.system, engine.body, &engine.system_analyse, &engine.spectrum,
                                      &engine.system_state, &engine.system_at[0]);
  } else {
    single_input(s, &engine.at[0], 0, 0);
    status = fb_body_spectrum_solve(&engine.body[0], &engine.analyse, &engine.spectrum,
                                    engine.is_formed ? &engine.plain : &engine.state, &engine.at[0]);
  }
  scene_put_weight(s, weight);
  return status;
}

/* Which joint a failure is about, for a message. */
static const char *scene_at_fault(const scene *s)
{
  static char text[64];
  const int at = scene_is_system(s) ? engine.system_work.joint : -1;
  text[0] = 0;
  for (int k = 0; k < s->n_joint && at >= 0; k++) {
    if (s->joint[k].at == at) {
      snprintf(text, sizeof text, " (joint %s)", s->joint[k].name);
    }
  }
  return text;
}
#endif
