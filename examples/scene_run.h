/* scene_run.h - runs a scene that scene.h has read. */
#ifndef SCENE_RUN_H
#define SCENE_RUN_H
#include "scene.h"
#include <time.h>

typedef struct scene_options { /* all zero: no files, no talk */
  const char *csv;             /* name of the file that the outputs go to */
  FILE *talk;                  /* progress, and what was chosen */
} scene_options;

/* What moves, as the outputs see it. */
typedef struct scene_view {
  fb_state pose[FB_MAX_BODIES];
  fb_motion motion[FB_MAX_BODIES];
  fb_energy energy;
  fb_momentum momentum;
} scene_view;

static struct scene_engine { /* one scene at a time */
  fb_body body[FB_MAX_BODIES];
  fb_body_work body_work;
  fb_state state;
  fb_input at[3]; /* start, middle, end of the step */
  fb_rk4_work rk4;
  fb_implicit_work implicit;
  fb_exponential exponential;
  fb_exponential_work exponential_work;
  fb_analyse_work analyse;
  double sum[SCENE_OUTPUTS];
  scene_view view;
} engine;

/* ---- what acts on a single body at t, of the pieces that hold `side` */

static void single_input(const scene *s, fb_input *input, double t, double side)
{
  memset(input, 0, sizeof *input);
  for (int k = 0; k < s->n_load; k++) {
    const scene_load *const l = &s->load[k];
    fb_load *const load = &input->load[input->n_load++];
    const double f = function_eval(&l->f, &s->tables, t, side).value;
    load->node = l->node;
    load->axes = l->axes;
    for (int i = 0; i < 3; i++) {
      (l->torque ? load->torque : load->force)[i] = (fb_real)(f * l->vector[i]);
    }
  }
  for (int k = 0; k < s->n_motion; k++) {
    const scene_motion *const m = &s->motion[k];
    const function_value f = function_eval(&m->f, &s->tables, t, side);
    for (int i = 0; i < 3; i++) {
      (m->rate ? input->w : input->v)[i] += (fb_real)(f.value * m->vector[i]);
      (m->rate ? input->w_dot : input->v_dot)[i] += (fb_real)(f.rate * m->vector[i]);
    }
  }
}

static fb_status single_start(scene *s)
{
  const scene_body *const b = &s->body[0];
  fb_real v[3], w[3], q_dot[FB_MAX_MODES];
  fb_state *const state = &engine.state;
  const int held = b->level.base == FB_BASE_PRESCRIBED;
  fb_status status = fb_body_init(&engine.body[0], &engine.body_work, &b->shape, &b->level);
  status = status ? status : fb_state_init(&engine.body[0], state);
  single_input(s, &engine.at[2], 0, 0);
  for (int i = 0; i < 3; i++) {
    state->rho[i] = (fb_real)b->position[i];
    v[i] = held ? engine.at[2].v[i] : (fb_real)b->velocity[i];
    w[i] = held ? engine.at[2].w[i] : (fb_real)b->spin[i];
  }
  for (int i = 0; i < 4; i++) {
    state->quat[i] = (fb_real)b->attitude[i];
  }
  for (int k = 0; k < engine.body[0].n; k++) {
    state->q[k] = (fb_real)b->q[k];
    q_dot[k] = (fb_real)b->q_dot[k];
  }
  fb_quat_normalize(state->quat);
  return status ? status : fb_state_from_velocity(&engine.body[0], state, v, w, q_dot);
}

static double single_limit(void)
{
  return 0.2 * (double)fb_rk4_limit(&engine.body[0], FB_R(0.0), FB_R(0.0));
}

static fb_status single_step(const scene *s, double t, double dt)
{
  fb_state *const x = &engine.state;
  fb_input *const at = engine.at;
  single_input(s, &at[0], t, t + 0.5 * dt);
  single_input(s, &at[1], t + 0.5 * dt, t + 0.5 * dt);
  single_input(s, &at[2], t + dt, t + 0.5 * dt);
  switch (s->scheme) {
  case FB_SCHEME_MIDPOINT:
    return fb_midpoint_step(&engine.body[0], x, &engine.implicit, &at[1], (fb_real)dt, 0);
  case FB_SCHEME_SDIRK:
    return fb_sdirk_step(&engine.body[0], x, &engine.implicit, &at[0], &at[2], (fb_real)dt, 0);
  case FB_SCHEME_EXPONENTIAL:
    return fb_exponential_step(&engine.body[0], &engine.exponential, x, &engine.exponential_work, &at[0], &at[1],
                               &at[2]);
  default:
    return fb_rk4_step(&engine.body[0], x, &engine.rk4, &at[0], &at[1], &at[2], (fb_real)dt);
  }
}

static fb_status single_look(const scene *s, scene_view *view, double t)
{
  fb_status status;
  single_input(s, &engine.at[2], t, t);
  view->pose[0] = engine.state;
  status = fb_body_motion(&engine.body[0], &view->motion[0], &engine.state, &engine.at[2]);
  status = status ? status : fb_body_energy(&engine.body[0], &view->energy, &engine.state, &engine.at[2]);
  return status ? status : fb_body_momentum(&engine.body[0], &view->momentum, &engine.state, &engine.at[2]);
}

/* ---- outputs */

static double node_output(const scene *s, const scene_view *view, const scene_output *o)
{
  fb_node_motion node;
  fb_imu imu;
  const fb_body *const body = &engine.body[o->body];
  const fb_real gravity[3] = {(fb_real)s->gravity[0], (fb_real)s->gravity[1], (fb_real)s->gravity[2]};
  const fb_real *const value[] = {node.displacement,
                                  node.rotation,
                                  node.position,
                                  node.velocity,
                                  node.acceleration,
                                  node.angular_rate,
                                  node.angular_acceleration,
                                  imu.specific_force,
                                  imu.angular_rate};
  if (fb_body_node_motion(body, &node, &view->pose[o->body], &view->motion[o->body], o->at) != FB_OK) {
    return (double)NAN;
  }
  fb_imu_eval(&imu, &node, gravity);
  return (double)value[o->quantity - SCENE_DISPLACEMENT][o->axis];
}

static double energy_output(const fb_energy *e, int which)
{
  const double part[] = {(double)(e->kinetic + e->strain + e->gravity), (double)e->kinetic, (double)e->strain,
                         (double)e->gravity};
  return part[which];
}

static double scene_value(const scene *s, const scene_view *view, const scene_output *o)
{
  const fb_motion *const m = &view->motion[o->body];
  switch (o->quantity) {
  case SCENE_SPIN:
    return (double)m->w[o->axis];
  case SCENE_ATTITUDE:
    return (double)view->pose[o->body].quat[o->axis];
  case SCENE_REACTION_FORCE:
    return (double)m->reaction_force[o->axis];
  case SCENE_REACTION_TORQUE:
    return (double)m->reaction_torque[o->axis];
  case SCENE_MODE:
    return (double)view->pose[o->body].q[o->at];
  case SCENE_MODE_RATE:
    return (double)m->q_dot[o->at];
  case SCENE_STRAIN:
    return (double)fb_gauge_eval(&s->body[o->body].gauge[o->at], view->pose[o->body].q);
  case SCENE_ENERGY:
    return energy_output(&view->energy, o->axis);
  case SCENE_MOMENTUM:
    return (double)view->momentum.linear[o->axis];
  case SCENE_ANGULAR_MOMENTUM:
    return (double)view->momentum.angular[o->axis];
  default:
    return node_output(s, view, o);
  }
}

/* ---- measures: rows are at equal intervals */

typedef struct scene_tally {
  int n;
  double sum, most, least, last;
} scene_tally;

static void scene_tally_add(scene_tally *tally, scene_kind kind, double x)
{
  tally->sum += kind == SCENE_RMS ? x * x : x;
  tally->most = tally->n == 0 ? x : fmax(tally->most, x);
  tally->least = tally->n == 0 ? x : fmin(tally->least, x);
  tally->last = x;
  tally->n++;
}

static double scene_tally_end(const scene_tally *tally, scene_kind kind)
{
  switch (kind) {
  case SCENE_MAX:
    return tally->most;
  case SCENE_MIN:
    return tally->least;
  case SCENE_MEAN:
    return tally->sum / tally->n;
  case SCENE_RMS:
    return sqrt(tally->sum / tally->n);
  default:
    return tally->last;
  }
}

/* ---- a run */

typedef struct scene_run_state {
  FILE *csv;
  scene_tally tally[SCENE_MEASURES];
  time_t begin, told;
} scene_run_state;

static void scene_header(const scene *s, FILE *csv)
{
  fputs("t [s]", csv);
  for (int k = 0; k < s->n_output; k++) {
    fprintf(csv, ",%s [%s]", s->output[k].label, scene_quantities[s->output[k].quantity].unit);
  }
  fputs("\n", csv);
}

/* What a row says: to the file and to the measures. */
static fb_status scene_row(const scene *s, scene_run_state *run, double t)
{
  double value[SCENE_OUTPUTS];
  const fb_status status = single_look(s, &engine.view, t);
  if (status != FB_OK) {
    return status;
  }
  for (int k = 0; k < s->n_output; k++) {
    value[k] = scene_value(s, &engine.view, &s->output[k]);
  }
  if (run->csv) {
    fprintf(run->csv, "%.12g", t);
    for (int k = 0; k < s->n_output; k++) {
      fprintf(run->csv, ",%.12g", value[k]);
    }
    fputs("\n", run->csv);
  }
  for (int k = 0; k < s->n_measure; k++) {
    if (t >= s->measure[k].after * (1 - 1e-12)) {
      scene_tally_add(&run->tally[k], s->measure[k].kind, value[s->measure[k].output]);
    }
  }
  return FB_OK;
}

static void scene_progress(const scene *s, const scene_options *o, scene_run_state *run, double t)
{
  const time_t now = time(NULL);
  if (o->talk && now > run->told && now > run->begin + 1) {
    run->told = now;
    fprintf(o->talk, "\r%3.0f %%, %.4g of %.4g s", 100 * t / s->duration, t, s->duration);
    fflush(o->talk);
  }
}

static int scene_loop(scene *s, const scene_options *o, scene_run_state *run)
{
  const long rows = (long)ceil(s->duration / s->interval * (1 - 1e-9));
  const double interval = s->duration / (double)rows;
  const long steps = (long)ceil(interval / s->step * (1 - 1e-9));
  const double dt = interval / (double)steps;
  fb_status status = scene_row(s, run, 0);
  if (status == FB_OK && s->scheme == FB_SCHEME_EXPONENTIAL) {
    status = fb_exponential_init(&engine.exponential, &engine.body_work, &engine.body[0], (fb_real)dt);
  }
  for (long k = 0; k < rows * steps && status == FB_OK; k++) {
    const double t = (double)k * dt;
    status = single_step(s, t, dt);
    if (status == FB_OK && (k + 1) % steps == 0) {
      status = scene_row(s, run, (double)((k + 1) / steps) * interval);
      scene_progress(s, o, run, t);
    }
    if (status != FB_OK) {
      return scene_fail(s, "at %.6g s, step of %.4g s: %s", t, dt, fb_status_string(status));
    }
  }
  return status == FB_OK ? 0 : scene_fail(s, "at the start: %s", fb_status_string(status));
}

/* 0, or 1 and the reason in s->message. */
static int scene_run(scene *s, const scene_options *o)
{
  static scene_run_state run;
  fb_status status;
  int failed;
  memset(&run, 0, sizeof run);
  memset(&engine, 0, sizeof engine);
  run.begin = time(NULL);
  status = single_start(s);
  if (status != FB_OK) {
    return scene_fail(s, "%s", fb_status_string(status));
  }
  s->step = s->step > 0 ? s->step : fmin(s->interval, single_limit());
  if (o->csv) {
    run.csv = fopen(o->csv, "w");
    if (!run.csv) {
      return scene_fail(s, "cannot write %s: %s", o->csv, strerror(errno));
    }
    scene_header(s, run.csv);
  }
  failed = scene_loop(s, o, &run);
  if (run.csv && fclose(run.csv) != 0 && !failed) {
    failed = scene_fail(s, "cannot write %s", o->csv);
  }
  for (int k = 0; k < s->n_measure; k++) {
    s->measured[k] = run.tally[k].n > 0 ? scene_tally_end(&run.tally[k], s->measure[k].kind) : (double)NAN;
  }
  return failed;
}
#endif
