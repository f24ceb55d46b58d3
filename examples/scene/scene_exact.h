/* scene_exact.h - a scene of one geometrically exact beam: described as such, or a beam of modes taken exactly. See
   scene.h. */
#ifndef SCENE_EXACT_H
#define SCENE_EXACT_H
#include "scene_body.h"

/* ---- reading */

/* node X|tip [NAME], of the chain or of the branch that is described */
static void scene_read_exact_node(text_file *t, const scene *s, scene_body *body)
{
  const int k = body->n_node;
  if (k == SCENE_NODES + 1) {
    text_fail(t, "more than %d nodes", SCENE_NODES);
    return;
  }
  body->node_at[k].on = s->exact.on;
  body->node_at[k].x = text_take(t, "tip") ? HUGE_VAL : text_number(t, "the node's place");
  if (text_more(t)) {
    text_name(t, "a node", body->node_name[k]);
  }
  body->n_node++;
  text_end_of_line(t);
}

/* A line of `body NAME exact`. */
static void scene_read_exact_line(text_file *t, scene *s, scene_body *body, const char *word)
{
  static const char *const once[] = {"length",   "elements",      "attitude", /* a branch has them, too */
                                     "position", "root",          "tip",      "gravity", "velocity", "dissipation",
                                     "damping",  "damping_ratio", "spin",     "modes",   "box"};
  for (int k = s->exact.on ? 3 : 0; k < (int)(sizeof once / sizeof *once); k++) {
    if (strcmp(word, once[k]) == 0) {
      text_once(t, &body->seen, word);
    }
  }
  if (strcmp(word, "node") == 0) {
    scene_read_exact_node(t, s, body);
  } else {
    exact_line(t, &s->exact, word);
  }
}

/* Nodes and what is missing, at the end of a body's lines. */
static void scene_place_exact(text_file *t, scene *s, scene_body *body)
{
  exact_places(t, &s->exact);
  for (int k = 0; k < body->n_node && !t->failed; k++) {
    exact_spot at = body->node_at[k];
    at.x = fmin(at.x, exact_length(&s->exact, at.on));
    body->element_node[k] = exact_nearest(t, &s->exact, &at, "a node");
  }
}

/* What a beam of modes has and an exact one has not. */
static void scene_check_conversion(text_file *t)
{
  const fb_beam_desc *const beam = &model.part[0].beam;
  const fb_base base = model.level.base;
  const fb_preload *const p = &model.part[0].modes.preload;
  const fb_real *const at = beam->position, *const turn = beam->attitude;
  if (model.level.mu > FB_R(0.0)) {
    model_at(t, NULL, "central_gravity");
    text_fail(t, "central_gravity of an exact beam: it acts on bodies with modes");
  }
  if (model.kind != MODEL_BEAM || beam->n_point > 0) {
    text_fail(t, "exact takes a straight beam, as the only body; bent ones are described by body NAME exact");
  } else if (beam->root != FB_ROOT_CLAMPED && (beam->root != FB_ROOT_FREE || base != FB_BASE_FREE || model.hub)) {
    model_at(t, &model.part[0], "root");
    text_fail(t, "an exact beam is clamped to its body, which `base` holds");
  } else if ((base == FB_BASE_PINNED || base == FB_BASE_HINGED) &&
             FB_FABS(at[0]) + FB_FABS(at[1]) + FB_FABS(at[2]) > 0) {
    model_at(t, &model.part[0], "position");
    text_fail(t, "an exact beam on a pin or hinge turns about its root: no position");
  } else if (base == FB_BASE_HINGED && FB_FABS(turn[1]) + FB_FABS(turn[2]) > 0) {
    model_at(t, &model.part[0], "attitude");
    text_fail(t, "the hinge of an exact beam is along its own z");
  } else if (FB_FABS(p->force) + FB_FABS(p->acceleration) + FB_FABS(p->spin) > 0) {
    model_at(t, &model.part[0], "preload");
    text_fail(t, "preload is that of modes: give an exact beam the loads themselves");
  }
}

/* A rigid body in other axes, which R maps to those that it is in. */
static void scene_turn_lump(fb_lump *lump, const fb_real R[9])
{
  const fb_real *const J = lump->inertia, *const c = lump->center;
  const fb_real inertia[9] = {J[0], J[3], J[4], J[3], J[1], J[5], J[4], J[5], J[2]}, center[3] = {c[0], c[1], c[2]};
  fb_real back[9], half[9], turned[9];
  for (int i = 0; i < 9; i++) {
    back[i] = R[3 * (i % 3) + i / 3];
  }
  fb_mat33_mul(half, inertia, R);
  fb_mat33_mul(turned, back, half);
  fb_mat33_mul_vec3(lump->center, back, center);
  for (int i = 0; i < 3; i++) {
    lump->inertia[i] = turned[4 * i];
    lump->inertia[3 + i] = turned[i < 2 ? 1 + i : 5];
  }
}

/* Section axes at x to those of the beam. */
static void scene_section_axes(fb_real R[9], fb_real x)
{
  fb_section section;
  fb_real turn[3] = {0, 0, 0}, quat[4];
  fb_beam_section_eval(&model_beam[0], &section, x);
  turn[0] = section.twist;
  fb_quat_from_rotvec(quat, turn);
  fb_quat_to_mat33(R, quat);
}

/* Lumps, and the hub as one on the root: from axes of the beam or of its body to those of the section there. */
static void scene_convert_lumps(text_file *t, exact_text *m)
{
  const fb_beam_desc *const beam = &model.part[0].beam;
  fb_real R[9], section[9];
  for (int k = 0; k < beam->n_lump; k++) {
    m->desc.lump[k] = beam->lump[k];
    m->lump_at[k].x = (double)beam->length * beam->lump[k].node / beam->n_element;
    scene_section_axes(R, (fb_real)m->lump_at[k].x);
    scene_turn_lump(&m->desc.lump[k], R);
  }
  m->n_lump = beam->n_lump;
  if (model.hub && m->n_lump == FB_MAX_LUMPS) {
    text_fail(t, "more than %d lumps, of which the hub of an exact beam is one", FB_MAX_LUMPS);
  } else if (model.hub) {
    fb_lump *const hub = &m->desc.lump[m->n_lump];
    hub->mass = (fb_real)model.hub_mass;
    for (int i = 0; i < 6; i++) {
      hub->center[i % 3] = (fb_real)model.hub_center[i % 3] - beam->position[i % 3];
      hub->inertia[i] = (fb_real)model.hub_inertia[i];
    }
    scene_section_axes(section, 0);
    fb_mat33_mul(R, model_beam[0].axes, section);
    scene_turn_lump(hub, R);
    m->lump_at[m->n_lump++].x = 0;
  }
}

/* The beam of modes that was read, exactly. Gravity of the scene comes at the start. */
static void scene_convert_exact(text_file *t, scene *s, scene_body *body)
{
  static const int held[] = {FB_END_FREE, FB_END_CLAMPED, FB_END_PINNED, FB_END_CLAMPED & ~FB_HOLD_RZ};
  const fb_beam_desc *const beam = &model.part[0].beam;
  fb_exact_desc *const d = &s->exact.desc;
  fb_status status = FB_OK;
  exact_begin(&s->exact);
  scene_check_conversion(t);
  if (t->failed) {
    return;
  }
  d->length = beam->length;
  d->n_element = s->exact_elements;
  d->n_station = beam->n_station;
  d->root = held[model.level.base];
  memcpy(d->position, beam->position, sizeof d->position);
  memcpy(d->attitude, beam->attitude, sizeof d->attitude);
  if (!text_seen(&s->seen, "gravity")) {
    memcpy(d->gravity, model.level.gravity, sizeof d->gravity);
  }
  for (int k = 0; k < beam->n_station && status == FB_OK; k++) {
    status = fb_exact_station_init(&d->station[k], &beam->station[k]);
    d->station[k].x = beam->station[k].x;
    d->station[k].twist = beam->station[k].twist;
  }
  scene_convert_lumps(t, &s->exact);
  if (status != FB_OK) {
    text_fail(t, "the beam, exactly: %s", refusal_text(status));
    return;
  }
  body->n_node = model.n_mark + 1;
  for (int k = 0; k < model.n_mark; k++) {
    body->node_at[k + 1].x = model.mark[k].x[0];
  }
  scene_place_exact(t, s, body);
}

/* ---- motion */

#define EXACT_PARTS 64    /* in which the loads grow beside a nudge, and.. */
#define EXACT_HALVINGS 24 /* ..of the nudge then */

struct scene_exact {
  fb_exact beam;
  fb_exact_state state;
  fb_exact_work work;
  fb_exact_input input;
  fb_exact_node node[FB_MAX_EXACT + 1];
  fb_exact_spectrum spectrum;
  fb_exact_spectrum_work spectrum_work;
};
SCENE_RUNS(struct scene_exact, exact_run, );

/* Loads, or nudges, at t, of the pieces that hold `side`. */
static void exact_add_loads(const scene *s, int nudges, double t, double side)
{
  fb_exact_input *const input = &exact_run.input;
  for (int k = 0; k < s->n_load; k++) {
    if (s->load[k].nudge == nudges) {
      fb_load *const load = &input->load[input->n_load++];
      *load = scene_load_at(s, &s->load[k], t, side);
      load->node = s->body[0].element_node[s->load[k].node];
    }
  }
}

/* Where supports are at t, of the pieces that hold `side`. */
static void exact_add_places(const scene *s, double t, double side)
{
  fb_exact_input *const input = &exact_run.input;
  for (int k = 0; k < s->n_motion; k++) {
    const scene_motion *const m = &s->motion[k];
    if (m->support) {
      fb_support_place *const place = &input->support[input->n_support++];
      const double f = function_eval(&m->f, &s->tables, t, side).value;
      memset(place, 0, sizeof *place);
      place->node = s->body[0].element_node[m->node];
      for (int i = 0; i < 3; i++) {
        (m->rate ? place->rotation : place->displacement)[i] = (fb_real)(f * m->vector[i]);
      }
    }
  }
}

/* What acts at t, supports at their places of `end`. */
static void exact_input(const scene *s, double t, double side, double end)
{
  fb_exact_input *const input = &exact_run.input;
  *input = s->exact.input;
  exact_add_loads(s, 0, t, side);
  exact_add_places(s, end, side);
  for (int k = 0; k < s->n_motion; k++) {
    const scene_motion *const m = &s->motion[k];
    const double f = function_eval(&m->f, &s->tables, t, side).value;
    for (int i = 0; i < 3 && !m->support; i++) {
      (m->rate ? input->w : input->v)[i] += (fb_real)(f * m->vector[i]);
    }
  }
}

/* Loads and motion at the start. */
static void exact_start_input(const scene *s)
{
  exact_input(s, 0, 0, 0);
  for (int i = 0; i < 3; i++) {
    exact_run.input.v[i] += (fb_real)s->body[0].velocity[i];
    exact_run.input.w[i] += (fb_real)s->body[0].spin[i];
  }
}

static void exact_scale(fb_real force[3], fb_real torque[3], double part)
{
  for (int i = 0; i < 3; i++) {
    force[i] *= (fb_real)part;
    torque[i] *= (fb_real)part;
  }
}

/* Parts of the loads and of the nudges at the start. */
static void exact_nudged_input(const scene *s, double part, double nudge)
{
  fb_exact_input *const input = &exact_run.input;
  int n;
  exact_start_input(s);
  n = input->n_load;
  exact_add_loads(s, 1, 0, 0);
  for (int k = 0; k < input->n_load; k++) {
    exact_scale(input->load[k].force, input->load[k].torque, k < n ? part : nudge);
  }
  for (int k = 0; k < s->exact.n_all; k++) {
    exact_scale(input->line[k].force, input->line[k].torque, part);
  }
}

/* The steady state. With nudges the loads grow beside them, then they are taken away half by half: of the states that a
   buckled beam has, the one to that side is left. */
static fb_status exact_trim(const scene *s)
{
  const int nudged = text_seen(&s->seen, "nudge") > 0;
  fb_status status = FB_OK;
  for (int k = 1; k <= EXACT_PARTS && nudged && status == FB_OK; k++) {
    exact_nudged_input(s, (double)k / EXACT_PARTS, 1);
    status = fb_exact_trim(&exact_run.beam, &exact_run.state, &exact_run.work, &exact_run.input);
  }
  for (int k = 1; k <= EXACT_HALVINGS && nudged && status == FB_OK; k++) {
    exact_nudged_input(s, 1, ldexp(1, -k));
    status = fb_exact_trim(&exact_run.beam, &exact_run.state, &exact_run.work, &exact_run.input);
  }
  exact_start_input(s);
  return status ? status : fb_exact_trim(&exact_run.beam, &exact_run.state, &exact_run.work, &exact_run.input);
}

static fb_status exact_start(const scene *s)
{
  const scene_body *const b = &s->body[0];
  fb_exact_desc desc = s->exact.desc;
  fb_status status;
  for (int i = 0; i < 3; i++) {
    desc.gravity[i] += (fb_real)s->gravity[i];
  }
  status = fb_exact_init(&exact_run.beam, &desc);
  exact_start_input(s);
  status = status ? status : fb_exact_state_init(&exact_run.beam, &exact_run.state, &exact_run.work, &exact_run.input);
  if (status == FB_OK) {
    scene_reals(exact_run.state.base_position, b->position, 3);
    scene_reals(exact_run.state.base_quat, b->attitude, 4);
    status = fb_quat_normalize(exact_run.state.base_quat);
  }
  if (s->trim) {
    return status ? status : exact_trim(s);
  }
  return status;
}

static fb_status exact_step(const scene *s, double t, double dt)
{
  exact_input(s, t + 0.5 * dt, t + 0.5 * dt, t + dt);
  return fb_exact_step(&exact_run.beam, &exact_run.state, &exact_run.work, &exact_run.input, (fb_real)dt);
}

/* The frame that the root carries along; the base frame where the root is clamped. */
static void exact_pose(fb_state *pose)
{
  const fb_real *const q = exact_run.beam.quat;
  const fb_real back[4] = {q[0], -q[1], -q[2], -q[3]};
  fb_real R[9];
  fb_quat_mul(pose->quat, exact_run.node[0].quat, back);
  fb_quat_to_mat33(R, pose->quat);
  for (int i = 0; i < 3; i++) {
    pose->rho[i] = exact_run.node[0].position[i];
    for (int j = 0; j < 3; j++) {
      pose->rho[i] -= R[3 * i + j] * exact_run.beam.r[j] * exact_run.beam.length;
    }
  }
}

static fb_status exact_look(scene_view *view)
{
  fb_status status = fb_exact_nodes_eval(&exact_run.beam, exact_run.node, &exact_run.state);
  status = status ? status : fb_exact_energy_eval(&exact_run.beam, &view->energy, &exact_run.state);
  status = status ? status : fb_exact_momentum_eval(&exact_run.beam, &view->momentum, &exact_run.state);
  exact_pose(&view->motion.pose[0]);
  return status;
}

/* In the axes of the root's frame, less the undeformed place. */
static double exact_displacement(const fb_state *pose, int node, int axis)
{
  fb_real R[9], d;
  fb_quat_to_mat33(R, pose->quat);
  d = -exact_run.beam.r[3 * node + axis] * exact_run.beam.length;
  for (int j = 0; j < 3; j++) {
    d += R[3 * j + axis] * (exact_run.node[node].position[j] - pose->rho[j]);
  }
  return (double)d;
}

/* [rad] The elastic part: of a root that turns, without its turn, and then within half a turn. */
static double exact_rotation(const fb_state *pose, int node, int axis)
{
  const fb_real *const p = pose->quat, *const q = exact_run.beam.quat + 4 * node;
  const fb_real from_pose[4] = {p[0], -p[1], -p[2], -p[3]}, from_section[4] = {q[0], -q[1], -q[2], -q[3]};
  fb_real seen[4], turn[4], phi[3];
  if ((exact_run.beam.held[0] & (FB_HOLD_RX | FB_HOLD_RY | FB_HOLD_RZ)) == (FB_HOLD_RX | FB_HOLD_RY | FB_HOLD_RZ)) {
    return (double)exact_run.node[node].rotation[axis];
  }
  fb_quat_mul(seen, from_pose, exact_run.node[node].quat);
  fb_quat_mul(turn, seen, from_section);
  fb_quat_to_rotvec(phi, turn);
  return (double)phi[axis];
}

/* From section axes of a node to those that quat maps to. */
static double exact_turned(const fb_real quat[4], const fb_real x[3], int axis)
{
  fb_real R[9];
  fb_quat_to_mat33(R, quat);
  return (double)(R[3 * axis] * x[0] + R[3 * axis + 1] * x[1] + R[3 * axis + 2] * x[2]);
}

/* [m/s] of the body's origin, inertial axes: the root carries it along. */
static double exact_origin_velocity(const fb_state *pose, int axis)
{
  const fb_exact_node *const root = &exact_run.node[0];
  fb_real d[3], w[3], across[3];
  for (int i = 0; i < 3; i++) {
    d[i] = pose->rho[i] - root->position[i];
    w[i] = (fb_real)exact_turned(root->quat, root->angular_rate, i);
  }
  fb_vec3_cross(across, w, d);
  return exact_turned(root->quat, root->velocity, axis) + (double)across[axis];
}

/* [N m] of what holds the root, about the body's origin, body axes. */
static double exact_origin_torque(int axis)
{
  const fb_exact_node *const root = &exact_run.node[0];
  fb_real r[3], F[3], across[3];
  for (int i = 0; i < 3; i++) {
    r[i] = exact_run.beam.r[i] * exact_run.beam.length;
    F[i] = (fb_real)exact_turned(exact_run.beam.quat, root->reaction_force, i);
  }
  fb_vec3_cross(across, r, F);
  return exact_turned(exact_run.beam.quat, root->reaction_moment, axis) + (double)across[axis];
}

static double exact_value(const scene *s, const scene_view *view, const scene_output *o)
{
  const int at = scene_quantities[o->quantity].place == SCENE_AT_NODE ? s->body[0].element_node[o->at] : 0;
  const fb_exact_node *const node = &exact_run.node[at];
  const fb_state *const pose = &view->motion.pose[0];
  const int origin = o->at == 0; /* of the body: the beam may begin elsewhere */
  switch (o->quantity) {
  case SCENE_DISPLACEMENT:
    return exact_displacement(pose, at, o->axis);
  case SCENE_ROTATION:
    return exact_rotation(pose, at, o->axis);
  case SCENE_POSITION:
    return (double)(origin ? pose->rho : node->position)[o->axis];
  case SCENE_VELOCITY:
    return origin ? exact_origin_velocity(pose, o->axis) : exact_turned(node->quat, node->velocity, o->axis);
  case SCENE_RATE:
    return exact_turned(node->quat, node->angular_rate, o->axis);
  case SCENE_GYRO:
    return (double)node->angular_rate[o->axis];
  case SCENE_INTERNAL_FORCE:
    return (double)node->force[o->axis];
  case SCENE_INTERNAL_MOMENT:
    return (double)node->moment[o->axis];
  case SCENE_SPIN:
    return exact_turned(exact_run.beam.quat, node->angular_rate, o->axis);
  case SCENE_ATTITUDE:
    return (double)pose->quat[o->axis];
  case SCENE_REACTION_FORCE:
    return exact_turned(exact_run.beam.quat, node->reaction_force, o->axis);
  default:
    return exact_origin_torque(o->axis);
  }
}

/* Does an exact beam have this output? */
static int exact_has(scene_quantity quantity)
{
  static const scene_quantity not_there[] = {SCENE_ACCELERATION, SCENE_RATE_DOT,  SCENE_SPECIFIC_FORCE,
                                             SCENE_MODE,         SCENE_MODE_RATE, SCENE_STRAIN};
  for (int k = 0; k < (int)(sizeof not_there / sizeof *not_there); k++) {
    if (not_there[k] == quantity) {
      return 0;
    }
  }
  return 1;
}

/* The slowest modes about the present state, and one more where there is one: a pair +-growth is as slow. */
static fb_status exact_spectrum(const scene *s, int count)
{
  const int more = count < FB_EXACT_MODES ? count + 1 : count;
  fb_status status;
  exact_input(s, 0, 0, 0);
  status = fb_exact_spectrum_solve(&exact_run.beam, &exact_run.spectrum_work, &exact_run.spectrum, &exact_run.state,
                                   &exact_run.input, more);
  return status == FB_OK || more == count
             ? status
             : fb_exact_spectrum_solve(&exact_run.beam, &exact_run.spectrum_work, &exact_run.spectrum, &exact_run.state,
                                       &exact_run.input, count);
}

/* A step whose error, of order 2, adds up to `accuracy` of the slowest mode at the end: w T (w dt)^2/12. */
static double exact_choose(const scene *s, double accuracy)
{
  double dt = s->interval;
  if (exact_spectrum(s, 2) == FB_OK) {
    const double w = fmax((double)exact_run.spectrum.im[0], (double)exact_run.spectrum.im[1]);
    dt = w > 0 ? fmin(dt, sqrt(12 * accuracy / (w * s->duration)) / w) : dt;
  }
  return dt;
}
#endif
