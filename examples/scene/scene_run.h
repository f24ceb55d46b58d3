/* scene_run.h - runs a scene that scene.h has read. */
#ifndef SCENE_RUN_H
#define SCENE_RUN_H
#include "scene_auto.h"
#include "scene_draw.h"
#include "scene_margins.h"
#include "scene_modes.h"
#include <signal.h>
#include <time.h>

typedef struct scene_options {       /* all zero: no files, no talk */
  const char *csv;                   /* name of the file that the outputs go to */
  FILE *rows;                        /* that file, which whoever opened it closes */
  const char *margins;               /* response of the loops of controllers over frequency */
  const char *linear;                /* linear model about the start, CSV or JSON */
  int modes;                         /* 1: prints the modes about the start to stdout, and does not run */
  int mode;                          /* with modes: which one the animation shows */
  const char *picture;               /* a few frames over each other, SVG */
  const char *animation;             /* SVG that moves */
  const char *frames;                /* folder for numbered frames, SVG */
  int n_frame;                       /* of them and of the animation, 0: 120 */
  FILE *talk;                        /* what was chosen */
  FILE *warn;                        /* what may be wrong */
  FILE *progress;                    /* what a long run takes */
  int live;                          /* 1: it is a terminal, on which a line tells how far the run is */
  const volatile sig_atomic_t *stop; /* not 0: the run ends before its next row; NULL: it goes to its end */
} scene_options;

/* ---- outputs */

/* Section axes. */
static double internal_output(const scene *s, const scene_output *o)
{
  fb_node_loads loads;
  const fb_system_motion *const m = &engine.view.motion;
  const fb_status status =
      scene_is_system(s)
          ? fb_system_node_loads_eval(&engine.system, engine.body, &loads, m, &engine.system_at[0], o->body, o->at)
          : fb_body_node_loads_eval(&engine.body[0], &loads, &engine.state, &m->motion[0], &engine.at[0], o->at);
  return status != FB_OK                       ? (double)NAN
         : o->quantity == SCENE_INTERNAL_FORCE ? (double)loads.force[o->axis]
                                               : (double)loads.moment[o->axis];
}

static double node_output(const scene_output *o)
{
  fb_node_motion node;
  fb_real gravity[3];
  fb_imu imu;
  const fb_real *const value[] = {node.displacement,
                                  node.rotation,
                                  node.position,
                                  node.velocity,
                                  node.acceleration,
                                  node.angular_rate,
                                  node.angular_acceleration,
                                  imu.specific_force,
                                  imu.angular_rate};
  if (fb_body_node_motion_eval(&engine.body[o->body], &node, &engine.view.motion.pose[o->body],
                               &engine.view.motion.motion[o->body], o->at) != FB_OK) {
    return (double)NAN;
  }
  if (fb_body_gravity_eval(&engine.body[o->body], gravity, node.position) != FB_OK) {
    return (double)NAN;
  }
  fb_imu_eval(&imu, &node, gravity);
  return (double)value[o->quantity - SCENE_DISPLACEMENT][o->axis];
}

/* A strain, of the modes that are kept. */
static double gauge_output(const scene *s, const scene_output *o)
{
  const fb_gauge *const all = &s->body[o->body].gauge[o->at];
  double strain = 0;
  for (int a = 0; a < all->n; a++) {
    const int at = engine.place[o->body][a];
    strain += at < 0 ? 0 : (double)(all->gain[a] * engine.view.motion.pose[o->body].q[at]);
  }
  return strain;
}

static double body_output(const scene *s, const scene_output *o)
{
  const fb_motion *const m = &engine.view.motion.motion[o->body];
  const fb_state *const pose = &engine.view.motion.pose[o->body];
  const int place = o->quantity == SCENE_STRAIN ? 0 : engine.place[o->body][o->at];
  switch (o->quantity) {
  case SCENE_SPIN:
    return (double)m->w[o->axis];
  case SCENE_ATTITUDE:
    return (double)pose->quat[o->axis];
  case SCENE_REACTION_FORCE:
    return (double)m->reaction_force[o->axis];
  case SCENE_REACTION_TORQUE:
    return (double)m->reaction_torque[o->axis];
  case SCENE_MODE:
    return place < 0 ? 0 : (double)pose->q[place];
  case SCENE_MODE_RATE:
    return place < 0 ? 0 : (double)m->q_dot[place];
  default:
    return gauge_output(s, o);
  }
}

/* Position and quaternion; what prescribes a velocity or a spin is along axes of the body. */
static double free_joint_output(const scene_output *o, int body)
{
  const fb_state *const pose = &engine.view.motion.pose[body];
  const fb_joint_motion *const m = &engine.view.motion.joint[body];
  fb_real R[9], along[3];
  if (o->quantity == SCENE_COORDINATE) {
    return (double)(o->axis < 3 ? pose->rho[o->axis] : pose->quat[o->axis - 2]);
  }
  fb_quat_to_mat33(R, pose->quat);
  fb_mat33_mulT_vec3(along, R, o->axis < 3 ? m->force : m->torque);
  return (double)along[o->axis % 3];
}

static double joint_output(const scene *s, const scene_output *o)
{
  const int at = s->joint[o->at].at;
  const fb_joint_motion *const m = &engine.view.motion.joint[at];
  if (s->joint[o->at].desc.kind == FB_JOINT_FREE && (o->quantity == SCENE_COORDINATE || o->quantity == SCENE_DRIVE)) {
    return free_joint_output(o, at);
  }
  switch (o->quantity) {
  case SCENE_JOINT_FORCE:
    return (double)m->force[o->axis];
  case SCENE_JOINT_TORQUE:
    return (double)m->torque[o->axis];
  case SCENE_COORDINATE:
    return (double)m->value[o->axis];
  case SCENE_COORDINATE_RATE:
    return (double)m->speed[o->axis];
  case SCENE_COORDINATE_ACCELERATION:
    return (double)m->acceleration[o->axis];
  default:
    return (double)m->drive[o->axis];
  }
}

static double whole_output(const scene_output *o)
{
  const fb_energy *const e = &engine.view.energy;
  const fb_real energy[] = {e->kinetic + e->strain + e->gravity, e->kinetic, e->strain, e->gravity};
  switch (o->quantity) {
  case SCENE_ENERGY:
    return (double)energy[o->axis];
  case SCENE_MOMENTUM:
    return (double)engine.view.momentum.linear[o->axis];
  case SCENE_ANGULAR_MOMENTUM:
    return (double)engine.view.momentum.angular[o->axis];
  default:
    return (double)engine.view.motion.power;
  }
}

static double rotor_output(const scene *s, const scene_output *o)
{
  const scene_rotor *const rotor = &s->rotor[o->at];
  const fb_motion *const motion = &engine.view.motion.motion[rotor->body];
  return (double)(o->quantity == SCENE_ROTOR_SPEED ? motion->rotor_speed : motion->rotor_momentum)[rotor->at];
}

static double scene_value(const scene *s, const scene_output *o)
{
  if (s->is_exact && scene_quantities[o->quantity].place < SCENE_AT_CONTROL) {
    return exact_value(s, &engine.view, o);
  }
  switch (scene_quantities[o->quantity].place) {
  case SCENE_AT_NODE:
    return scene_is_internal(o) ? internal_output(s, o) : node_output(o);
  case SCENE_AT_JOINT:
  case SCENE_AT_AXIS:
    return joint_output(s, o);
  case SCENE_AT_SPRING:
    return (double)(o->quantity == SCENE_LENGTH ? engine.view.motion.spring[o->at].length
                                                : engine.view.motion.spring[o->at].tension);
  case SCENE_AT_ROTOR:
    return rotor_output(s, o);
  case SCENE_AT_CONTROL:
    return remembered[s->control[o->at].acting + o->axis];
  case SCENE_AT_ALLOCATION:
    return remembered[o->at];
  case SCENE_AT_ALL:
    return whole_output(o);
  default:
    return body_output(s, o);
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

/* ---- comparison with what is known */

/* The largest difference of the output from a table between its rows: those that lie on rows of the run. */
static void scene_compare(const scene *s, scene_reference *r, double t, double value)
{
  const function *const table = &r->table;
  const function_row *const row = s->tables.row + table->first;
  const double first = fmax(row[0].t, r->from), last = fmin(row[table->n - 1].t, r->to), slack = 1e-6 * s->interval;
  if (t < first - slack || t > last + slack) {
    return;
  }
  while (r->next < table->n && row[r->next].t < t - slack) {
    r->next++;
  }
  if (r->next < table->n && row[r->next].t <= t + slack) {
    const double known = r->factor * row[r->next].value;
    r->largest = fmax(r->largest, fabs(known));
    r->difference = fabs(value - known) <= r->difference ? r->difference : fabs(value - known);
    r->compared++;
  }
}

static double scene_allowed(double tolerance, int relative, double size)
{
  return relative ? tolerance * size : tolerance;
}

/* Counts what is beyond its tolerance. */
static void scene_judge(scene *s)
{
  for (int k = 0; k < s->n_expectation; k++) {
    scene_expectation *const e = &s->expectation[k];
    e->difference = fabs(s->measured[e->measure] - e->value);
    s->missed += !(e->difference <= scene_allowed(e->tolerance, e->relative, fabs(e->value)));
  }
  for (int k = 0; k < s->n_reference; k++) {
    const scene_reference *const r = &s->reference[k];
    s->missed += !(r->compared > 0 && r->difference <= scene_allowed(r->tolerance, r->relative, r->largest));
  }
}

/* ---- pictures */

/* A point as it is seen: inertial, or in the frame of a body. */
static void scene_seen(const scene *s, double out[3], const fb_real position[3])
{
  const fb_state *const pose = &engine.view.motion.pose[s->view_of < 0 ? 0 : s->view_of];
  fb_real R[9];
  if (s->view_of < 0) {
    for (int i = 0; i < 3; i++) {
      out[i] = (double)position[i];
    }
    return;
  }
  fb_quat_to_mat33(R, pose->quat);
  for (int i = 0; i < 3; i++) {
    out[i] = 0;
    for (int j = 0; j < 3; j++) {
      out[i] += (double)(R[3 * j + i] * (position[j] - pose->rho[j]));
    }
  }
}

static void scene_add_point(const scene *s, scene_line *line, int body, int node)
{
  fb_node_motion at;
  if (line->n < SCENE_POINTS && fb_body_node_motion_eval(&engine.body[body], &at, &engine.view.motion.pose[body],
                                                         &engine.view.motion.motion[body], node) == FB_OK) {
    scene_seen(s, line->x[line->n++], at.position);
  }
}

/* A beam alone as its line; else from the origin to each node that is on no beam, and along each beam, and back. */
static void scene_add_body(const scene *s, scene_line *line, int b)
{
  const scene_body *const body = &s->body[b];
  const int alone = body->kind == MODEL_BEAM;
  for (int k = 1; k < body->n_node && !alone; k++) {
    if (!body->on_beam[k]) {
      scene_add_point(s, line, b, 0);
      scene_add_point(s, line, b, k);
    }
  }
  for (int beam = 0; beam < body->n_beam; beam++) {
    const int root = body->n_node + beam * body->n_drawn;
    if (!alone) {
      scene_add_point(s, line, b, 0);
    }
    for (int k = 0; k < body->n_drawn; k++) {
      scene_add_point(s, line, b, root + k);
    }
    for (int k = body->n_drawn - 2; k >= 0 && beam + 1 < body->n_beam; k--) {
      scene_add_point(s, line, b, root + k);
    }
  }
  for (int k = line->n; k < 2; k++) {
    scene_add_point(s, line, b, 0); /* a dot */
  }
}

/* A place that the ground holds, as it is seen; clamped: and that of what it holds, which goes on along the line. */
static void scene_add_mark(scene_frame *frame, const double at[3], const scene_line *clamped)
{
  scene_line *const mark = &frame->line[film.n_line];
  if (film.n_line == SCENE_LINES) {
    return;
  }
  memcpy(mark->x[0], at, sizeof mark->x[0]);
  mark->n = 1;
  for (int p = 0; clamped && p < clamped->n && mark->n < 2; p++) {
    const double *const x = clamped->x[p];
    if (fabs(x[0] - at[0]) + fabs(x[1] - at[1]) + fabs(x[2] - at[2]) > 0) {
      memcpy(mark->x[mark->n++], x, sizeof mark->x[0]);
    }
  }
  film.n_line++;
}

/* Is it more than nothing? */
static int scene_moves(const fb_real x[3])
{
  return FB_FABS(x[0]) + FB_FABS(x[1]) + FB_FABS(x[2]) > FB_R(0.0);
}

/* How the base of a body alone moves: bit 0, it turns; bit 1, it travels, and nothing is held by the ground. */
static int scene_base_motion(const scene *s)
{
  int moves = s->is_exact ? scene_moves(s->exact.input.w) + 2 * scene_moves(s->exact.input.v) : 0;
  for (int k = 0; k < s->n_motion; k++) {
    moves |= s->motion[k].support ? 0 : s->motion[k].rate ? 1 : 2;
  }
  return moves;
}

/* Root, tip and supports of an exact beam. */
static void scene_mark_exact(const scene *s, scene_frame *frame)
{
  const fb_exact_desc *const d = &s->exact.desc;
  const int moves = scene_base_motion(s), root = d->root == FB_END_DEFAULT ? FB_END_CLAMPED : d->root;
  for (int k = 0; k < d->n_support + 2 && moves < 2; k++) {
    const int held = k == 0 ? root : k == 1 ? d->tip : d->support[k - 2].held;
    const int node = k == 0 ? 0 : k == 1 ? d->n_element : d->support[k - 2].node;
    scene_line next = {1, {{0}}};
    double at[3];
    scene_seen(s, at, exact_run.node[node].position);
    scene_seen(s, next.x[0], exact_run.node[node > 0 ? exact_run.beam.inboard[node - 1] : 1].position);
    if (held != FB_END_FREE && held != FB_END_DEFAULT) {
      scene_add_mark(frame, at, (held & FB_END_GUIDED) == FB_END_GUIDED && moves == 0 ? &next : NULL);
    }
  }
}

/* The base of a body alone. */
static void scene_mark_base(const scene *s, scene_frame *frame)
{
  const fb_base base = s->body[0].level.base;
  const int moves = scene_base_motion(s), clamped = base == FB_BASE_PRESCRIBED && moves == 0;
  const scene_line *const line = &frame->line[0];
  double at[3];
  scene_seen(s, at, engine.view.motion.pose[0].rho);
  if (base != FB_BASE_FREE && moves < 2) {
    scene_add_mark(frame, clamped && line->n > 0 ? line->x[0] : at, clamped ? line : NULL);
  }
}

/* A joint to the ground: its place, or that of what slides along it. */
static void scene_mark_joint(const scene *s, scene_frame *frame, const fb_joint_desc *d)
{
  scene_line at = {0, {{0}}};
  if (scene_joint_kinds[d->kind].moves) {
    scene_add_point(s, &at, d->child, d->child_node);
  } else {
    scene_seen(s, at.x[0], d->position);
  }
  scene_add_mark(frame, at.x[0], d->kind == FB_JOINT_RIGID ? &frame->line[d->child] : NULL);
}

/* What the ground holds. */
static void scene_mark_ground(const scene *s, scene_frame *frame)
{
  film.n_line = film.n_part = 2 * film.n_body + s->n_spring;
  if (s->is_exact) {
    scene_mark_exact(s, frame);
  } else if (!scene_is_system(s)) {
    scene_mark_base(s, frame);
  }
  for (int j = 0; j < s->n_joint; j++) {
    const fb_joint_desc *const d = &s->joint[j].desc;
    if (d->parent == FB_GROUND && d->kind != FB_JOINT_FREE) {
      scene_mark_joint(s, frame, d);
    }
  }
  for (int j = 0; j < s->n_spring; j++) {
    const scene_line *const line = &frame->line[2 * s->n_body + j];
    for (int side = 0; side < 2 && line->n == 2; side++) {
      if (s->spring[j].desc.body[side] == FB_GROUND) {
        scene_add_mark(frame, line->x[side], NULL);
      }
    }
  }
}

/* The chain of an exact beam, or a branch from its node on. */
static void scene_film_exact(const scene *s, scene_line *line, int on)
{
  const fb_exact_desc *const d = &s->exact.desc;
  int first = 0, n = d->n_element, root = 0;
  for (int b = 0; b < on; b++) {
    first += n;
    n = d->branch[b].n_element;
    root = d->branch[b].node;
  }
  for (int k = 0; k < SCENE_POINTS; k++) {
    const int along = k * n / (SCENE_POINTS - 1);
    scene_seen(s, line->x[line->n++], exact_run.node[along > 0 ? first + along : root].position);
  }
}

/* Bodies as scene_add_body draws them; joints from node to origin, springs from
   point to point. */
static void scene_film_frame(const scene *s, double t)
{
  scene_frame *const frame = &film.frame[film.n];
  memset(frame, 0, sizeof *frame);
  frame->t = t;
  film.n_body = s->is_exact ? 1 + s->exact.desc.n_branch : s->n_body;
  for (int l = 0; l < film.n_body && s->is_exact; l++) {
    scene_film_exact(s, &frame->line[l], l);
  }
  for (int b = 0; b < s->n_body && !s->is_exact; b++) {
    scene_add_body(s, &frame->line[b], b);
  }
  for (int j = 0; j < s->n_joint; j++) {
    const fb_joint_desc *const d = &s->joint[j].desc;
    scene_line *const line = &frame->line[s->n_body + d->child];
    if (!s->joint[j].loop && d->parent != FB_GROUND) {
      if (s->body[d->parent].kind != MODEL_BEAM) {
        scene_add_point(s, line, d->parent, 0);
      }
      scene_add_point(s, line, d->parent, d->parent_node);
      scene_add_point(s, line, d->child, 0);
    }
  }
  for (int j = 0; j < s->n_spring; j++) {
    scene_line *const line = &frame->line[2 * s->n_body + j];
    fb_real x[2][3];
    if (scene_spring_points(x, s, j) == FB_OK) {
      scene_seen(s, line->x[line->n++], x[0]);
      scene_seen(s, line->x[line->n++], x[1]);
    }
  }
  scene_mark_ground(s, frame);
  film.n++;
}

/* The animation of mode k, from 1: a period in the frame that turns with the scene, a tenth of its size. */
static int scene_animate_mode(scene *s, const char *name, int k)
{
  enum { FRAMES = 49 };
  static scene_mode mode[SCENE_MODES];
  static modal_shape z;
  const int n = scene_modes(s, mode);
  char title[sizeof s->title];
  double far;
  if (n < 0 || k < 1 || k > n) {
    return n < 0 ? 1 : scene_fail(s, "--mode %d: the scene has %d modes", k, n);
  }
  modal_take(&z, s, k - 1);
  far = modal_size(&z, s);
  if (!(mode[k - 1].undamped > 0) || !(far > 0)) {
    return scene_fail(s, "--mode %d: rigid-body motion or rotors, nothing oscillates", k);
  }
  film.n = 0;
  for (int frame = 0; frame < FRAMES; frame++) {
    const double phase = 2 * function_pi * frame / (FRAMES - 1), size = 0.1 / far;
    const fb_status status = modal_look(s, &z, size * cos(phase), -size * sin(phase));
    if (status != FB_OK) {
      return scene_fail(s, "mode %d is not to be drawn: %s", k, refusal_text(status));
    }
    scene_film_frame(s, phase);
  }
  snprintf(title, sizeof title, "mode %d%s%s: %.6g rad/s, %.6g Hz", k, mode[k - 1].name[0] ? ", " : "",
           mode[k - 1].name, mode[k - 1].damped, mode[k - 1].damped / (2 * function_pi));
  memcpy(s->title, title, sizeof title);
  s->duration = 2 * function_pi / mode[k - 1].undamped;
  scene_project(s->view);
  return scene_write_animation(s, name);
}

static int scene_write_pictures(scene *s, const scene_options *o)
{
  int failed = 0;
  if (film.n == 0) {
    return 0;
  }
  scene_project(s->view);
  for (int k = 0; k < film.n && o->frames && !failed; k++) {
    failed = scene_write_frame(s, o->frames, k);
  }
  if (o->animation && !failed) {
    failed = scene_write_animation(s, o->animation);
  }
  return failed || !o->picture ? failed : scene_write_picture(s, o->picture);
}

/* ---- a run */

#define SCENE_HALVINGS 30 /* at most, of a chosen step */

typedef struct scene_run_state {
  FILE *csv;
  const scene_options *o; /* NULL: no progress */
  scene_tally tally[SCENE_MEASURES];
  time_t begin, told;
  clock_t clock;              /* at the first step */
  int foretold;               /* what it takes was told */
  long long steps;            /* taken */
  double bent[FB_MAX_BODIES]; /* largest sum of modal deflections of each body, of its size */
  int event, halved, broken;  /* halved: how often the step was; broken: errno of the file of outputs */
  long row, frames;           /* frames: wanted; 0: no pictures */
} scene_run_state;

static void scene_header(const scene *s, FILE *csv)
{
  fputs("t [s]", csv);
  for (int k = 0; k < s->n_output; k++) {
    fprintf(csv, ",%s [%s]", s->output[k].label, s->output[k].unit);
  }
  fputs("\n", csv);
}

/* Where the body has no limit of its own its size is twice that (fb_body_desc.deflection_limit). */
static void scene_note_bent(const scene *s, scene_run_state *run)
{
  for (int k = 0; k < s->n_body; k++) {
    const fb_body *const body = &engine.body[k];
    double sum = 0;
    if (s->body[k].level.deflection_limit > FB_R(0.0) || body->effects & FB_EFFECT_LARGE_DEFLECTION) {
      continue;
    }
    for (int a = 0; a < body->n; a++) {
      sum += fabs((double)engine.view.motion.pose[k].q[a]) * (double)body->reach[a];
    }
    run->bent[k] = body->n > 0 ? fmax(run->bent[k], 0.5 * sum / (double)body->deflection_limit) : 0;
  }
}

static void scene_warn_bent(scene *s, const scene_run_state *run, FILE *warn)
{
  for (int k = 0; k < s->n_body; k++) {
    if (run->bent[k] > 0.1) {
      scene_warn(
          s, warn,
          "warning: body %s bends by up to %.2g %% of its size: displacements of modes err by up to 1 %% at 6 %%, "
          "several percent from 15 %% on; `effects large` bends by any angle",
          s->body[k].name, 100 * run->bent[k]);
    }
  }
}

/* What a row says: to the file, the measures and the references. */
static fb_status scene_row(scene *s, scene_run_state *run, double t)
{
  double value[SCENE_OUTPUTS];
  const fb_status status = scene_look(s, t);
  if (status != FB_OK) {
    return status;
  }
  for (int k = 0; k < s->n_output; k++) {
    value[k] = scene_value(s, &s->output[k]);
    seen_note(s, k, value[k]);
  }
  if (!s->is_exact) {
    scene_note_bent(s, run);
  }
  if (run->csv) {
    fprintf(run->csv, "%.12g", t);
    for (int k = 0; k < s->n_output; k++) {
      fprintf(run->csv, ",%.12g", value[k]);
    }
    fputs("\n", run->csv);
    run->broken = ferror(run->csv) ? errno : 0;
  }
  for (int k = 0; k < s->n_measure; k++) {
    const scene_measure *const m = &s->measure[k];
    if (m->kind < SCENE_FREQUENCY && t >= m->after * (1 - 1e-12)) {
      scene_tally_add(&run->tally[k], m->kind, value[m->output]);
    }
  }
  for (int k = 0; k < s->n_reference; k++) {
    scene_compare(s, &s->reference[k], t, value[s->reference[k].output]);
  }
  if (film.n < run->frames && run->row * (run->frames - 1) >= film.n * timing.rows) {
    scene_film_frame(s, t);
  }
  return FB_OK;
}

/* "; the modes of body NAME want such short steps" where neither rows, nor turns, nor joints want chosen ones of rk4:
   that of the shortest limit. */
static void scene_why_short(const scene *s, char why[96])
{
  const fb_real w = (fb_real)automatic.spin, a = (fb_real)automatic.acceleration;
  const int chosen = !s->is_exact && !(s->step > 0) && engine.integrator == FB_INTEGRATOR_RK4;
  double least =
      chosen && s->dt < 0.5 * fmin(s->interval, 0.03 / automatic.spin) ? 2 * scene_limit(s, FB_INTEGRATOR_RK4) : 0;
  why[0] = 0;
  for (int k = 0; k < s->n_body && least > 0; k++) {
    const double limit = (double)fb_rk4_limit(&engine.body[k], w, a);
    if (limit < least) {
      least = limit;
      snprintf(why, 96, "; the modes of body %s want such short steps", s->body[k].name);
    }
  }
}

/* Once, after the first second: how long a run of more than 10 s takes, as far as the steps up to t tell. */
static void scene_foretell(const scene *s, scene_run_state *run, double t)
{
  static const struct {
    double least, unit; /* [s] */
    const char *name;
  } units[] = {{18000, 3600, "hours"}, {300, 60, "minutes"}, {0, 1, "s"}};
  const double spent = (double)(clock() - run->clock) / CLOCKS_PER_SEC, rest = spent * (s->duration / t - 1);
  char why[96];
  int k = 0;
  if (spent < 1 || run->foretold) {
    return;
  }
  run->foretold = 1;
  while (rest < units[k].least) {
    k++;
  }
  if (rest > 10) {
    scene_why_short(s, why);
    fprintf(run->o->progress,
            "%s%s: %.3g steps; the first %.2g %% of them took %.2g s, the others will take some %.3g %s%s\n",
            run->o->live ? "\r" : "", s->path, timing.steps, 100 * t / s->duration, spent, rest / units[k].unit,
            units[k].name, why);
  }
}

/* Once a second rows go to their file, to be there if the run is killed, and a line tells how far it is. */
static void scene_progress(const scene *s, scene_run_state *run, double t)
{
  const scene_options *const o = run->o;
  const time_t now = time(NULL);
  if (!o || now <= run->told) {
    return;
  }
  run->told = now;
  if (run->csv && fflush(run->csv) != 0) {
    run->broken = errno;
  }
  if (o->progress && t > 0) {
    scene_foretell(s, run, t);
  }
  if (o->progress && o->live && now > run->begin + 1) {
    fprintf(o->progress, "\r%3.0f %%, %.4g of %.4g s", 100 * t / s->duration, t, s->duration);
    fflush(o->progress);
  }
}

/* At the line of the joint that it is about. */
static int scene_failed(scene *s, const char *when, fb_status status)
{
  const int at = scene_is_system(s) ? engine.system_work.joint : -1;
  int line = 0;
  for (int k = 0; k < s->n_joint && at >= 0; k++) {
    line = s->joint[k].at == at ? s->joint[k].line : line;
  }
  return scene_fail_at(s, line, "%s: %s%s%s%s", when, fb_status_string(status), scene_at_fault(s),
                       status == FB_ERR_STEP ? "; give a shorter step, or none" : "", refusal_detail(status));
}

/* The joint with an axis that nothing holds: where it is locked, and nothing else, there is a steady state. NULL:
   none. */
static const scene_joint *scene_loose(scene *s, int *axis)
{
  for (int k = 0; k < s->n_joint; k++) {
    const int axes = scene_axes(&s->joint[k]);
    for (*axis = 0; *axis < (axes > 2 ? 1 : axes); (*axis)++) { /* more than two are one */
      fb_axis_mode *const mode = &s->joint[k].desc.mode[*axis], was = *mode;
      fb_status status;
      *mode = FB_AXIS_LOCKED;
      status = was == FB_AXIS_FREE ? scene_start(s) : FB_ERR_CONTRADICTION;
      *mode = was;
      if (status == FB_OK) {
        return &s->joint[k];
      }
    }
  }
  return NULL;
}

/* A spring between the ground and a body that nothing else holds: trims know no rest of such a body. NULL: none. */
static const scene_spring *scene_only_spring(const scene *s, int *body)
{
  for (int k = 0; k < s->n_spring; k++) {
    const fb_spring *const d = &s->spring[k].desc;
    const scene_joint *joint;
    *body = d->body[d->body[0] == FB_GROUND];
    joint = scene_joint_under(s, *body);
    if ((d->body[0] == FB_GROUND || d->body[1] == FB_GROUND) &&
        (!joint || (joint->desc.kind == FB_JOINT_FREE && !text_seen(&joint->seen, "stiffness")))) {
      return &s->spring[k];
    }
  }
  return NULL;
}

static int scene_no_start(scene *s, fb_status status)
{
  int axis = 0, body = 0;
  const scene_spring *const only = s->trim && status == FB_ERR_UNREST ? scene_only_spring(s, &body) : NULL;
  const scene_joint *const loose = s->trim && status == FB_ERR_SINGULAR ? scene_loose(s, &axis) : NULL;
  char which[24] = "some axis";
  if (loose && scene_axes(loose) < 3) {
    snprintf(which, sizeof which, "axis %d", axis + 1);
  }
  if (loose) {
    return scene_fail_at(s, loose->line, "no steady state: nothing holds %s of joint %s: lock it, or give it a spring",
                         which, loose->name);
  }
  if (only) {
    return scene_fail_at(s, only->line,
                         "trim does not find where body %s rests on springs alone: give it a joint NAME free ground %s "
                         "with a line of six stiffnesses, a millionth of theirs",
                         s->body[body].name, s->body[body].name);
  }
  return scene_failed(s, s->trim ? "trim" : "start", status);
}

static int scene_is_stopped(const scene_run_state *run)
{
  return run->o && run->o->stop && *run->o->stop;
}

/* What happens at `begin`, which may say when the piece from there ends, and its steps; ends before the one that fails. */
static fb_status scene_take(scene *s, scene_run_state *run, scene_piece *p, double start, double last, double begin)
{
  fb_status status = scene_happen(s, &run->event, begin);
  *p = scene_piece_from(s, start, last, begin);
  for (long long k = 0; (double)k < p->steps && status == FB_OK && !scene_is_stopped(run); k++) {
    p->begin = begin + (double)k * p->dt;
    status = scene_step(s, p->begin, p->dt);
    if (run->steps++ % 64 == 0) {
      scene_progress(s, run, p->begin);
    }
  }
  p->begin = status == FB_OK ? p->end : p->begin;
  return status;
}

/* From a row, `start`, to the next. A chosen step that turns out to be too long is halved; one that is given is not. */
static fb_status scene_interval(scene *s, scene_run_state *run, double start, double last, char when[96])
{
  double t = start;
  fb_status status = FB_OK;
  while (t < last && status == FB_OK && !scene_is_stopped(run)) {
    scene_piece p;
    status = scene_take(s, run, &p, start, last, t);
    snprintf(when, 96, "at %.6g s, step of %.4g s", p.begin, p.dt);
    t = p.begin;
    if (status == FB_ERR_STEP && !(s->step > 0) && run->halved < SCENE_HALVINGS) {
      timing.longest = 0.5 * p.dt;
      run->halved++;
      status = FB_OK;
    }
  }
  return status;
}

/* From row to row. */
static int scene_loop(scene *s, const scene_options *o, scene_run_state *run)
{
  char when[96] = "at the start";
  fb_status status = FB_OK;
  engine.by_step = 0;
  run->o = o;
  run->clock = clock();
  while (run->row < timing.rows && status == FB_OK && !run->broken && !scene_is_stopped(run)) {
    status = scene_interval(s, run, (double)run->row * timing.interval, (double)(run->row + 1) * timing.interval, when);
    if (status == FB_OK && !scene_is_stopped(run)) {
      run->row++;
      status = scene_row(s, run, (double)run->row * timing.interval);
      scene_progress(s, run, (double)run->row * timing.interval);
    }
  }
  if (run->told > run->begin + 1 && o->progress && o->live) {
    fputs("\r                                        \r", o->progress);
  }
  if (run->halved > 0 && o->talk) {
    fprintf(o->talk, "some steps had to be shorter: %.3g s at most\n", timing.longest);
  }
  return status != FB_OK ? scene_failed(s, when, status)
         : run->broken   ? scene_fail(s, "cannot write %s: %s%s", o->csv, strerror(run->broken), output_left(o->csv))
         : run->row < timing.rows ? scene_fail(s, "stopped after the row of %.10g s, of %.10g s%s",
                                               (double)run->row * timing.interval, s->duration, output_left(o->csv))
                                  : 0;
}

/* Is the run short enough, and is what acts resolved by a step that is given? Tells of one that is not. */
static int scene_check_steps(scene *s, const scene_options *o)
{
  scene_steps steps = {HUGE_VAL, 0, 0};
  timing.longest = s->dt;
  timing.part = s->step > 0 ? HUGE_VAL : scene_part[s->is_exact ? FB_INTEGRATOR_MIDPOINT : engine.integrator];
  if (s->dt > 0) {
    steps = scene_count_steps(s);
  }
  timing.steps = steps.count;
  timing.taken = steps.longest;
  if (!(steps.count <= SCENE_STEPS)) {
    const double dt = fmin(s->dt, timing.part / scene_fastest(s));
    char why[96] = "";
    if (!(dt < s->dt)) {
      scene_why_short(s, why);
    }
    return scene_fail(s, "steps of %.3g s%s are %.3g or more in %g s; %g at most%s", dt,
                      dt < s->dt ? " for the fastest that acts" : "", s->duration / dt, s->duration, SCENE_STEPS, why);
  }
  if (s->step > 0 && steps.turn > 1) {
    scene_warn(s, o->warn,
               "warning: the fastest that acts goes through %.2g rad in a step of at most %.3g s; it wants less than 1",
               steps.turn, steps.longest);
  }
  if (!(s->step > 0) && o->talk) {
    if (!s->is_exact) {
      fprintf(o->talk, "integrator %s, ", scene_integrators[engine.integrator]);
    }
    fprintf(o->talk, "step at most %.3g s, %.10g steps\n", steps.longest, steps.count);
    fflush(o->talk);
  }
  return 0;
}

static void scene_warn_placed(scene *s, const char *what, const exact_spot *spot, int node, FILE *warn)
{
  const double length = exact_length(&s->exact, spot->on), at = exact_node_place(&s->exact, spot->on, node);
  if (fabs(fmin(spot->x, length) - at) > 1e-6 * length) {
    scene_warn(s, warn, "warning: %s at %.6g is taken at %.6g, the nearest node of %d elements", what, spot->x, at,
               s->exact.elements[spot->on]);
  }
}

/* What an exact beam has not where it is asked for. */
static void scene_warn_exact(scene *s, FILE *warn)
{
  const scene_body *const body = &s->body[0];
  for (int k = 1; k < body->n_node; k++) {
    scene_warn_placed(s, "a node", &body->node_at[k], body->element_node[k], warn);
  }
  for (int k = 0; k < s->exact.n_lump; k++) {
    scene_warn_placed(s, "a lump", &s->exact.lump_at[k], s->exact.desc.lump[k].node, warn);
  }
  for (int k = 0; k < s->exact.n_load; k++) {
    scene_warn_placed(s, "a load", &s->exact.load_at[k], s->exact.input.load[k].node, warn);
  }
  for (int k = 0; k < s->exact.n_support; k++) {
    scene_warn_placed(s, "a support", &s->exact.support_at[k], s->exact.desc.support[k].node, warn);
  }
  for (int k = 0; k < s->exact.n_move; k++) {
    scene_warn_placed(s, "a support that is moved", &s->exact.move_at[k], s->exact.input.support[k].node, warn);
  }
}

/* An exact beam takes forces at its nodes, of which the origin of its body is one where it begins there. */
static int scene_check_exact(scene *s)
{
  const fb_real *const at = s->exact.desc.position;
  const int elsewhere = FB_FABS(at[0]) + FB_FABS(at[1]) + FB_FABS(at[2]) > 0;
  int moved = s->exact.n_move, begins = moved > 0;
  if (s->exact.input.n_load + s->n_load > FB_MAX_LOADS) {
    return scene_fail(s, "body %s of line %d: more than %d loads, those of the body among them", s->body[0].name,
                      s->body[0].line, FB_MAX_LOADS);
  }
  for (int k = 0; k < s->n_motion; k++) {
    moved += s->motion[k].support;
    begins |= s->motion[k].support && function_eval(&s->motion[k].f, &s->tables, 0, 0).value != 0;
  }
  if (moved > FB_MAX_LUMPS) {
    return scene_fail(s, "body %s of line %d: more than %d moves of supports, by `move` and `motion`", s->body[0].name,
                      s->body[0].line, FB_MAX_LUMPS);
  }
  if (begins && !s->trim) {
    return scene_fail_at(s, s->exact.n_move > 0 ? s->exact.move_line[0] : s->body[0].line,
                         "supports that are not where they are built at the start want a line trim");
  }
  for (int k = 0; k < s->n_load && elsewhere; k++) {
    if (s->load[k].node == 0 && !s->load[k].torque) {
      return scene_fail(s,
                        "body %s of line %d: a force on its origin, and the exact beam begins elsewhere: give a node",
                        s->body[0].name, s->body[0].line);
    }
  }
  return 0;
}

/* Refuses internal loads of beams that have none: only lines of large deflection know them. */
static int scene_check_internal(scene *s)
{
  for (int k = 0; k < s->n_output; k++) {
    const scene_output *const o = &s->output[k];
    if (scene_is_internal(o) && engine.body[o->body].node[o->at].line.line == 0) {
      return scene_fail_at(s, s->body[o->body].line, "output %s: %s is of beams with large deflection (effects large)",
                           o->label, scene_quantities[o->quantity].name);
    }
  }
  return 0;
}

/* Bodies of the effects and modes that are given or advised; what happens at most, where that is asked for. */
static int scene_build(scene *s, const scene_options *o)
{
  int asked = s->duration > 0 && !(s->step > 0);
  fb_status status;
  automatic.doubted = 0;
  if (s->is_exact) {
    scene_warn_exact(s, o->warn);
    return scene_check_exact(s);
  }
  for (int k = 0; k < s->n_body; k++) {
    asked |= s->body[k].tolerance > 0;
  }
  if (asked) {
    scene_run_rigid(s);
  }
  for (int k = 0; k < s->n_body; k++) {
    const int advised = s->body[k].tolerance > 0;
    if (advised && scene_advise(s, k, o->talk)) {
      return 1;
    }
    if (advised &&
        !((double)automatic.advice[k].error <= s->body[k].tolerance * (1 + 1e-9))) { /* rounding of the sum */
      scene_tell_missed(s, k, o->warn);
    }
    status = scene_init_body(s, k, advised ? &automatic.advice[k] : NULL);
    if (status != FB_OK) {
      return scene_fail_at(s, s->body[k].line, "body %s: %s", s->body[k].name, refusal_text(status));
    }
  }
  return scene_check_internal(s);
}

/* The fastest growth [1/s] among the n slowest of `all` modes, and those that are as slow as the last: of a pair
   +-growth neither comes before the other. */
static double scene_growth(const fb_real *re, const fb_real *im, int n, int all)
{
  const double last = hypot((double)re[n - 1], (double)im[n - 1]);
  while (n < all && hypot((double)re[n], (double)im[n]) <= 1.001 * last) {
    n++;
  }
  return -(double)fb_spectrum_margin(NULL, re, n);
}

/* The mode of n that is measured; -1: there is none. */
static int scene_find_mode(const scene_measure *m, const scene_mode *mode, int n)
{
  int found = -1, number = 0;
  for (int k = 0; k < n; k++) {
    const int is = m->near > 0  ? found < 0 || fabs(mode[k].damped - m->near) < fabs(mode[found].damped - m->near)
                   : m->mode[0] ? strcmp(mode[k].name, m->mode) == 0
                                : strcmp(mode[k].part, m->part) == 0 && number++ == m->output;
    found = is ? k : found;
  }
  return found;
}

/* Frequencies of modes that are chosen by name, by what moves or by nearness. */
static int scene_measure_chosen(scene *s)
{
  static scene_mode mode[SCENE_MODES];
  const int n = scene_modes(s, mode);
  for (int k = 0; k < s->n_measure && n >= 0; k++) {
    const scene_measure *const m = &s->measure[k];
    const int found = scene_is_chosen(m) ? scene_find_mode(m, mode, n) : 0;
    if (found < 0) {
      return scene_fail_at(s, m->line, "measure %s: no mode is %s%s%s (--modes lists them)", m->label,
                           m->mode[0] ? "called " : "one of ", m->mode, m->part);
    }
    if (scene_is_chosen(m)) {
      s->measured[k] = mode[found].damped;
    }
  }
  return n < 0;
}

/* Frequencies and growth about the start, where they are to be measured. */
static int scene_measure_spectrum(scene *s)
{
  const fb_real *const re = s->is_exact ? exact_run.spectrum.re : engine.spectrum.re;
  const fb_real *const im = s->is_exact ? exact_run.spectrum.im : engine.spectrum.im;
  int wanted = 0, chosen = 0, n;
  fb_status status;
  for (int k = 0; k < s->n_measure; k++) {
    const scene_measure *const m = &s->measure[k];
    const int asked = (m->kind == SCENE_FREQUENCY && !scene_is_chosen(m)) || m->kind == SCENE_GROWTH;
    wanted = asked && m->output >= wanted ? m->output + 1 : wanted;
    chosen |= scene_is_chosen(m);
  }
  if (chosen && scene_measure_chosen(s)) {
    return 1;
  }
  if (wanted == 0) {
    return 0;
  }
  status = s->is_exact ? exact_spectrum(s, wanted) : scene_spectrum(s);
  n = s->is_exact ? exact_run.spectrum.n : engine.spectrum.n;
  if (status != FB_OK || n < wanted) {
    return status ? scene_failed(s, "spectrum at the start", status)
                  : scene_fail(s, "the spectrum has %d modes, mode %d is to be measured", n, wanted);
  }
  for (int k = 0; k < s->n_measure; k++) {
    const scene_measure *const m = &s->measure[k];
    if (m->kind == SCENE_FREQUENCY && !scene_is_chosen(m)) {
      s->measured[k] = fabs((double)im[m->output]);
    } else if (m->kind == SCENE_GROWTH) {
      s->measured[k] = scene_growth(re, im, m->output + 1, n);
    }
  }
  return 0;
}

/* A loop closes near the start that is asked for, or elsewhere. */
/* Closing loops also moves modes, where joints have not the speeds of the linkage: they have a part of its energy then. */
static void scene_tell_bent(const scene *s, int b, FILE *talk)
{
  fb_real q[FB_MAX_MODES], asked[FB_MAX_MODES] = {0};
  double energy = 0;
  scene_start_modes(b, q, asked, &s->body[b]);
  for (int a = 0; a < engine.body[b].n; a++) {
    const double off = (double)(engine.view.motion.motion[b].q_dot[a] - asked[a]);
    energy += 0.5 * off * off;
  }
  if (energy > 1e-6 * (double)engine.view.energy.kinetic) {
    fprintf(
        talk,
        "body %s starts with modes that move, to close a loop at the speeds of the start: begin at rest, or `start` "
        "joints with the speeds of the linkage\n",
        s->body[b].name);
  }
}

static void scene_tell_moved(const scene *s, FILE *talk)
{
  for (int k = 0; k < s->n_joint && s->n_loop > 0 && !s->trim; k++) {
    const scene_joint *const joint = &s->joint[k];
    for (int axis = 0; axis < 2; axis++) {
      const double value = (double)engine.view.motion.joint[joint->at].value[axis], asked = joint->start[axis];
      const double speed = (double)engine.view.motion.joint[joint->at].speed[axis], wanted = joint->speed[axis];
      const char *const unit = scene_axis_slides(joint, axis) ? "m/s" : "rad/s";
      if (scene_seen_numbered(&joint->seen, "start", axis + 1) && fabs(value - asked) > 1e-6 * (1 + fabs(asked))) {
        fprintf(talk, "joint %s starts at %.6g instead of %.6g, where its loop is closed\n", joint->name, value, asked);
      }
      if (scene_seen_numbered(&joint->seen, "speed", axis + 1) && fabs(speed - wanted) > 1e-6 * (1 + fabs(wanted))) {
        fprintf(talk, "joint %s starts at %.6g %s instead of %.6g %s, where its loop is closed\n", joint->name, speed,
                unit, wanted, unit);
      }
    }
  }
  for (int b = 0; b < s->n_body && s->n_loop > 0 && !s->trim; b++) {
    scene_tell_bent(s, b, talk);
  }
}

static int scene_run_rows(scene *s, const scene_options *o, scene_run_state *run)
{
  fb_status status;
  seen_note_nothing();
  status = scene_row(s, run, 0);
  if (status != FB_OK) {
    return scene_failed(s, "at the start", status);
  }
  s->began = 1;
  // of a base that spins gyroscopic forces decide
  if (s->is_exact && s->trim && exact_run.work.unstable > 0 && fb_vec3_dot(exact_run.input.w, exact_run.input.w) == 0) {
    char why[160];
    scene_warn(s, o->warn, "warning: the steady state is unstable, in %d directions, %s", exact_run.work.unstable,
               exact_overstretched(why, &exact_run.beam, &exact_run.state) ? why : "as beyond a buckling load");
  }
  if (o->talk) {
    scene_tell_moved(s, o->talk);
  }
  return s->duration > 0 ? scene_loop(s, o, run) : 0;
}

/* Nothing measured or compared yet. */
static void scene_reset(scene *s)
{
  s->began = s->missed = 0;
  s->warning[0] = 0;
  for (int k = 0; k < s->n_measure; k++) {
    s->measured[k] = (double)NAN;
  }
  for (int k = 0; k < s->n_reference; k++) {
    scene_reference *const r = &s->reference[k];
    r->next = r->compared = 0;
    r->difference = r->largest = 0;
  }
}

/* What the descriptions of bodies may have wrong; sections are judged in SI units alone. */
static void scene_warn_bodies(scene *s, FILE *warn)
{
  for (int k = 0; k < s->n_body; k++) {
    if (s->body[k].warning[0]) {
      scene_warn(s, warn, "warning: body %s: %s", s->body[k].name, s->body[k].warning);
    }
    if (s->body[k].doubt[0] && strcmp(s->length_unit, "m") == 0 && strcmp(s->force_unit, "N") == 0) {
      scene_warn(s, warn, "warning: body %s: %s", s->body[k].name, s->body[k].doubt);
    }
  }
}

/* Builds the scene and puts it at its start. 1: the reason is in s->message. */
static int scene_make(scene *s, const scene_options *o)
{
  fb_status status;
  clear_memory(&engine, offsetof(struct scene_engine, body));
  scene_reset(s);
  scene_warn_bodies(s, o->warn);
  if (scene_build(s, o)) {
    return 1;
  }
  status = scene_start(s);
  if (status != FB_OK) {
    return scene_no_start(s, status);
  }
  if (automatic.doubted) {
    (void)scene_note(s, 0);
    scene_warn(s, o->warn,
               "warning: no run with rigid bodies tells what happens at most; what is chosen fits the start");
  }
  return 0;
}

/* 0: it ran, s->missed says how many references it missed; 1: the reason is in s->message, and s->began says whether it
   ran up to there or was refused. */
static int scene_run(scene *s, const scene_options *o)
{
  static scene_run_state run;
  int failed;
  memset(&run, 0, sizeof run);
  film.n = 0;
  run.frames = o->picture || o->animation || o->frames ? (o->n_frame > 0 ? o->n_frame : 120) : 0;
  run.begin = time(NULL);
  if (scene_make(s, o)) {
    return 1;
  }
  if (o->modes) {
    failed = scene_print_modes(s, stdout);
    return failed || !o->animation ? failed : scene_animate_mode(s, o->animation, o->mode > 0 ? o->mode : 1);
  }
  if (scene_measure_spectrum(s) || scene_measure_margins(s, o->margins, o->talk) ||
      scene_write_linear(s, o->linear, o->talk)) {
    return 1;
  }
  scene_clock_init(s, scene_rows(s));
  if (s->duration > 0) {
    scene_choose(s);
    if (scene_check_steps(s, o)) {
      return 1;
    }
  }
  run.csv = o->rows;
  if (run.csv) {
    scene_header(s, run.csv);
  }
  failed = scene_run_rows(s, o, &run);
  if (!failed && s->duration > 0 && !s->is_exact) {
    scene_tell_unresolved(s, engine.integrator, timing.taken, 10 * scene_accuracy, o->warn);
  }
  scene_warn_bent(s, &run, o->warn);
  failed = failed ? failed : scene_write_pictures(s, o);
  for (int k = 0; k < s->n_measure && !failed; k++) {
    if (run.tally[k].n > 0) {
      s->measured[k] = scene_tally_end(&run.tally[k], s->measure[k].kind);
    }
  }
  scene_judge(s);
  return failed;
}
#endif
