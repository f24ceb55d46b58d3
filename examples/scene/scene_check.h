/* scene_check.h - refuses what a scene says but would not use, and what contradicts something else. See scene.h. */
#ifndef SCENE_CHECK_H
#define SCENE_CHECK_H
#include "scene_wanted.h"

/* Complains about the line of a word that was there, if it was. */
static void scene_refuse(text_file *t, const text_words *words, const char *word, const char *why)
{
  const int line = text_seen(words, word);
  if (line > 0) {
    t->line = line;
    text_fail(t, "%s %s", word, why);
  }
}

/* ---- at the end of a body's lines */

/* The scene's gravity pulls the body that was read. */
static void scene_pull_body(text_file *t, const scene *s)
{
  const fb_real *const own = model.level.gravity;
  if (!text_seen(&s->seen, "gravity")) {
    return;
  }
  if (text_seen(&model.seen, "gravity") || fabs((double)own[0]) + fabs((double)own[1]) + fabs((double)own[2]) > 0) {
    model_at(t, NULL, "gravity");
    text_fail(t, "gravity of a body under that of the scene");
  }
  text_note(t, &model.seen, "gravity");
  scene_reals(model.level.gravity, s->gravity, 3);
  if (fabs(s->gravity[0]) + fabs(s->gravity[1]) + fabs(s->gravity[2]) > 0) {
    model.level.effects |= FB_EFFECT_GRAVITY;
  }
}

/* Modes that the start names are there. */
static void scene_check_modes(text_file *t, const scene *s, const scene_body *body)
{
  const int n = s->is_exact ? 0 : body->shape.n;
  for (int k = n + 1; k <= FB_MAX_MODES && !t->failed; k++) {
    const int line = scene_seen_numbered(&body->seen, "start_mode", k);
    if (line > 0) {
      t->line = line;
      text_fail(t, s->is_exact ? "an exact beam has no modes" : "the body has %d modes", n);
    }
  }
}

/* Effects that a form or truncated terms go with. */
static void scene_check_form(text_file *t, const scene_body *body)
{
  const fb_body_desc *const level = &body->level;
  const unsigned effects = level->effects;
  if (body->form.form == FB_FORM_FIRST && effects & (FB_EFFECT_SPIN_STIFFENING | FB_EFFECT_ACCELERATION_STIFFENING)) {
    scene_refuse(t, &body->seen, "form", "first has no quadratic displacement: effects strain, spin or linear");
  }
  if (body->form.stiffness_torque != FB_TORQUE_IDENTITY && !(effects & FB_EFFECT_NONLINEAR_STRAIN)) {
    scene_refuse(t, &body->seen, "form", "first with a stiffness torque of that kind wants effects strain");
  }
  if (body->form.form == FB_FORM_SECOND &&
      !(effects & FB_EFFECT_SPIN_COUPLING) != !(effects & FB_EFFECT_RESIDUAL_INERTIA)) {
    scene_refuse(t, &body->seen, "form", "second wants both of spin_coupling and residual_inertia, or neither");
  }
  if (level->truncation != FB_TRUNCATE_NONE && fb_effects_check(effects) != FB_OK) {
    scene_refuse(t, &body->seen, "truncate", "wants effects that are not half of something");
  }
}

/* Nodes have names of their own. */
static void scene_check_nodes(text_file *t, const scene_body *body)
{
  for (int k = 1; k < body->n_node && k < FB_MAX_NODES; k++) {
    for (int i = 1; i < k && body->node_name[k][0]; i++) {
      if (strcmp(body->node_name[i], body->node_name[k]) == 0) {
        text_fail(t, "two nodes have the name %s", body->node_name[k]);
      }
    }
  }
}

/* What `auto` needs, and what it does not know of. */
static void scene_check_auto(text_file *t, const scene_body *body)
{
  const unsigned wanted = body->level.effects & ~(unsigned)(FB_EFFECT_DAMPING | FB_EFFECT_GRAVITY);
  if (body->form.form != FB_FORM_MOMENTUM || body->level.truncation != FB_TRUNCATE_NONE) {
    scene_refuse(t, &body->seen, "auto", "chooses among effects of the momentum form, not truncated");
  }
  if (body->level.mu > FB_R(0.0)) {
    scene_refuse(t, &body->seen, "auto", "does not know central_gravity");
  }
  if (body->n_node < 2) {
    scene_refuse(t, &body->seen, "auto", "wants a node, whose displacement is to be right");
  }
  if (body->shape.n == 0) {
    scene_refuse(t, &body->seen, "auto", "wants modes to choose among");
  }
  if (model.by_frequency) {
    scene_refuse(t, &body->seen, "auto", "wants one damping ratio of parts whose modes are not orthogonal to rounding");
  }
  if (wanted != 0 && wanted != (unsigned)FB_EFFECTS_FULL) {
    scene_refuse(t, &body->seen, "auto", "chooses the effects itself: leave them out, but for gravity and damping");
  }
  for (int k = 1; k <= FB_MAX_MODES && body->tolerance > 0; k++) {
    const int line = scene_seen_numbered(&body->seen, "start_mode", k);
    if (line > 0 && !t->failed) {
      t->line = line;
      text_fail(t, "start_mode under auto, which knows only of what acts");
    }
  }
}

static void scene_check_exact_body(text_file *t, const scene *s, const scene_body *body)
{
  scene_refuse(t, &body->seen, "auto", "is that of bodies with modes");
  scene_refuse(t, &body->seen, "form", "is that of bodies with modes");
  scene_refuse(t, &body->seen, "truncate", "is that of bodies with modes");
  scene_refuse(t, &body->seen, "gauge", "is that of beams with modes");
  scene_refuse(t, &body->seen, "modes", "of an exact beam are not printed here: measure them");
  if (text_seen(&s->seen, "gravity")) {
    scene_refuse(t, &body->seen, "gravity", "of a body under that of the scene");
  }
  scene_check_modes(t, s, body);
  if (s->exact.desc.root == FB_END_CLAMPED || s->exact.desc.root == FB_END_DEFAULT) {
    scene_refuse(t, &body->seen, "start_velocity", "of a clamped root: it moves as `motion` says");
    scene_refuse(t, &body->seen, "start_spin", "of a clamped root: it moves as `motion` says");
  }
}

/* What chooses steps and steady states of systems knows no gravity of a center. */
static void scene_check_center(text_file *t, const scene *s, const scene_body *body)
{
  if (body->level.mu > FB_R(0.0)) {
    scene_refuse(t, &s->seen, "trim", "of bodies on joints does not know central_gravity");
    if (s->duration > 0 && !(s->step > 0)) {
      t->line = body->line;
      text_fail(t, "central_gravity of body %s wants a step", body->name);
    }
  }
}

/* ---- bodies alone, at the end of the file */

static void scene_check_single(text_file *t, const scene *s)
{
  const scene_body *const body = &s->body[0];
  const fb_base base = body->level.base;
  const int modal = body->shape.n > 0 || !s->is_exact;
  scene_refuse(t, &s->seen, "method", "is that of bodies on joints");
  if (body->form.form != FB_FORM_MOMENTUM && s->integrator == FB_INTEGRATOR_EXPONENTIAL) {
    scene_refuse(t, &s->seen, "integrator", "exponential moves the momentum form alone");
  }
  for (int k = 0; k < s->n_output; k++) {
    if (s->output[k].quantity == SCENE_POWER) {
      text_fail(t, "output %s: power is that of joints", s->output[k].label);
    }
  }
  if (modal && base == FB_BASE_FREE && !(body->shape.mass > FB_R(0.0))) {
    t->line = body->line;
    text_fail(t, "body %s is free and has no mass", body->name);
  }
  if (modal && base != FB_BASE_PRESCRIBED) {
    scene_refuse(t, &s->seen, "motion", "wants a body with `base prescribed`");
  }
  if (modal && base != FB_BASE_FREE) {
    scene_refuse(t, &body->seen, "start_velocity",
                 base == FB_BASE_PRESCRIBED ? "of a prescribed base: it moves as `motion` says"
                                            : "of a base that stays where it is");
  }
  if (modal &&
      (base == FB_BASE_PRESCRIBED || (base == FB_BASE_HINGED && fabs(body->spin[0]) + fabs(body->spin[1]) > 0))) {
    scene_refuse(t, &body->seen, "start_spin",
                 base == FB_BASE_PRESCRIBED ? "of a prescribed base: it moves as `motion` says"
                                            : "of a hinged base is about z");
  }
}

/* ---- bodies on joints */

/* Words of the start that the joint a body hangs by has no use for. */
static void scene_check_start(text_file *t, const scene *s, const scene_joint *joint)
{
  const scene_body *const body = &s->body[joint->desc.child];
  const int moves = joint->desc.mode[0] == FB_AXIS_FREE;
  const fb_joint_kind kind = joint->desc.kind;
  if (kind != FB_JOINT_FREE) {
    scene_refuse(t, &body->seen, "start_position", "of a body on a joint: its joints place it");
    scene_refuse(t, &body->seen, "start_velocity", "of a body on a joint: its joints move it");
  }
  if (kind != FB_JOINT_FREE && kind != FB_JOINT_SPHERICAL) {
    scene_refuse(t, &body->seen, "start_attitude", "of a body on a joint: its joints turn it");
    scene_refuse(t, &body->seen, "start_spin", "of a body on a joint: its joints turn it");
  }
  if (!moves) {
    scene_refuse(t, &body->seen, "start_velocity", "on a joint that is not free");
    scene_refuse(t, &body->seen, "start_spin", "on a joint that is not free");
  }
}

/* Does a joint exert a moment about that axis? The line that says so, 0: none. */
static int scene_moment_line(const scene *s, int at, int axis)
{
  const scene_joint *const joint = &s->joint[at];
  const fb_joint_desc *const d = &joint->desc;
  const int of_all = d->kind == FB_JOINT_SPHERICAL ? 0 : axis; /* its axes have one mode */
  const struct {
    const char *word;
    int there;
  } word[] = {{"stiffness", d->stiffness[axis] > FB_R(0.0)},
              {"damping", d->damping[axis] > FB_R(0.0)},
              {"friction", d->friction[axis] > FB_R(0.0)},
              {"mode", d->mode[of_all] != FB_AXIS_FREE}};
  for (int k = 0; k < (int)(sizeof word / sizeof word[0]); k++) {
    if (word[k].there) {
      return text_seen(&joint->seen, word[k].word) > 0 ? text_seen(&joint->seen, word[k].word) : joint->line;
    }
  }
  for (int k = 0; k < s->n_drive; k++) {
    if (s->drive[k].joint == at && s->drive[k].axis == axis) {
      return s->drive[k].line;
    }
  }
  for (int k = 0; k < s->n_event; k++) {
    if (s->event[k].joint == at && (s->event[k].axis == axis || of_all != axis) && s->event[k].mode != FB_AXIS_FREE) {
      return s->event[k].line;
    }
  }
  return scene_seen_numbered(&joint->seen, "stops", axis + 1);
}

/* Does a mode of a pinned root turn it about what the joint holds, all but the axis of a hinge and of a slide along it? */
static int scene_turns_held(const scene_body *body, const fb_joint_desc *d)
{
  const int hinge = d->kind == FB_JOINT_REVOLUTE || d->kind == FB_JOINT_CYLINDRICAL || d->kind == FB_JOINT_SCREW;
  fb_real R[9];
  fb_quat_to_mat33(R, d->child_attitude);
  for (int a = 0; a < body->shape.n && d->kind != FB_JOINT_SPHERICAL; a++) {
    const fb_real *const turn = body->turn[a];
    const double along = (double)(R[2] * turn[0] + R[5] * turn[1] + R[8] * turn[2]);
    const double whole = (double)(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]);
    if (whole - hinge * along * along > 1e-10 * whole) {
      return 1;
    }
  }
  return 0;
}

/* Modes of a root that is not clamped take no moment there: what a joint exerts about an axis would not bend the beam. */
static void scene_check_root(text_file *t, const scene *s, int at)
{
  const scene_joint *const joint = &s->joint[at];
  const scene_body *const body = &s->body[joint->desc.child];
  const fb_joint_kind kind = joint->desc.kind;
  if (body->root == FB_ROOT_CLAMPED || kind == FB_JOINT_FREE) {
    return;
  }
  if (body->root == FB_ROOT_FREE || scene_turns_held(body, &joint->desc)) {
    t->line = joint->line;
    text_fail(t, "modes of a %s root leave out how body %s moves on this joint: root clamped",
              body->root == FB_ROOT_FREE ? "free" : "pinned", body->name);
  }
  for (int axis = 0; axis < scene_axes(joint) && !t->failed; axis++) {
    const int line = scene_axis_slides(joint, axis) ? 0 : scene_moment_line(s, at, axis);
    if (line > 0) {
      t->line = line;
      text_fail(
          t,
          "a moment about axis %d of joint %s does not bend body %s, which has modes of a pinned root: root clamped "
          "and a hub, or effects large",
          axis + 1, joint->name, body->name);
    }
  }
}

/* A base other than free: of a body from a file it is let be where a joint takes its place. */
static void scene_check_base(text_file *t, const scene *s, int k)
{
  const scene_body *const body = &s->body[k];
  if (body->level.base != FB_BASE_FREE && (body->base_line > 0 || !scene_joint_under(s, k))) {
    t->line = body->base_line > 0 ? body->base_line : body->line;
    text_fail(t, "base of body %s among others or on a joint: %s", body->name,
              scene_joint_under(s, k) ? "leave it out, its joint says how it is held" : "give it a joint to ground");
  }
}

/* Does an event change the axis to that mode? */
static int scene_event_makes(const scene *s, int joint, int axis, fb_axis_mode mode)
{
  const int all = scene_axes(&s->joint[joint]) > 2;
  for (int k = 0; k < s->n_event; k++) {
    if (s->event[k].joint == joint && (all || s->event[k].axis == axis) && s->event[k].mode == mode) {
      return 1;
    }
  }
  return 0;
}

/* A value has no jumps. */
static int scene_jumps(const function *f)
{
  return f->kind == FUNCTION_STEP || f->kind == FUNCTION_PULSE;
}

/* A motor wants an axis that is free, a value or rate one that is prescribed: at the start, or by an event. */
static void scene_check_drive(text_file *t, const scene *s, const scene_drive *drive)
{
  const scene_joint *const joint = &s->joint[drive->joint];
  const int all = scene_axes(joint) > 2, axis = all ? 0 : drive->axis;
  const fb_axis_mode wanted = drive->kind == SCENE_MOTOR ? FB_AXIS_FREE : FB_AXIS_PRESCRIBED;
  t->line = drive->line;
  if (joint->desc.mode[axis] != wanted && !scene_event_makes(s, drive->joint, axis, wanted)) {
    text_fail(t, drive->kind == SCENE_MOTOR ? "a motor on an axis that is not free"
                                            : "a value or rate on an axis that is not prescribed");
  }
  if (drive->kind == SCENE_VALUE && scene_jumps(&drive->f)) {
    text_fail(t, "a value must not jump: take ramp or smooth");
  }
  if (drive->kind == SCENE_VALUE && scene_seen_numbered(&joint->seen, "start", axis + 1)) {
    text_fail(t, "a value on an axis with a start: one of them, or rate");
  }
  if (drive->kind == SCENE_VALUE && scene_has_drive(s, drive->joint, axis, SCENE_SPEED)) {
    text_fail(t, "value and rate of the same axis: one of them");
  }
}

/* Speeds at the start are those of axes that are free. */
static void scene_check_speeds(text_file *t, const scene_joint *joint)
{
  for (int axis = 0; axis < 2; axis++) {
    const int line = scene_seen_numbered(&joint->seen, "speed", axis + 1);
    if (line > 0 && joint->desc.mode[axis] != FB_AXIS_FREE) {
      t->line = line;
      text_fail(t, "a speed at the start of an axis that is not free");
    }
  }
}

/* Where a spring rests, and the speed of friction, say nothing without the spring and the friction. */
static void scene_check_lone(text_file *t, const scene *s)
{
  for (int k = 0; k < s->n_joint; k++) {
    const text_words *const seen = &s->joint[k].seen;
    if (!text_seen(seen, "stiffness")) {
      scene_refuse(t, seen, "rest", "of a joint wants a line stiffness, of the spring that rests there");
    }
    if (!text_seen(seen, "friction")) {
      scene_refuse(t, seen, "friction_speed", "of a joint wants a line friction");
    }
  }
  for (int k = 0; k < s->n_spring; k++) {
    const text_words *const seen = &s->spring[k].seen;
    if (!text_seen(seen, "stiffness")) {
      scene_refuse(t, seen, "length", "of a spring wants a line stiffness: unstretched it has that length");
    }
  }
}

static void scene_check_system(text_file *t, const scene *s)
{
  scene_refuse(t, &s->seen, "motion", "is that of a single body's base; prescribe a joint instead");
  if (s->integrator != FB_INTEGRATOR_RK4 && s->integrator != FB_INTEGRATOR_SDIRK) {
    scene_refuse(t, &s->seen, "integrator", "of bodies on joints is rk4 or sdirk");
  }
  for (int k = 0; k < s->n_body; k++) {
    if (s->body[k].form.form != FB_FORM_MOMENTUM) {
      scene_refuse(t, &s->body[k].seen, "form", "is that of a body alone: joints want momentum");
    }
    scene_check_center(t, s, &s->body[k]);
  }
  for (int k = 0; k < s->n_body; k++) {
    scene_check_base(t, s, k);
  }
  for (int k = 0; k < s->n_joint; k++) {
    if (!s->joint[k].loop) {
      scene_check_start(t, s, &s->joint[k]);
      scene_check_root(t, s, k);
    }
    scene_check_speeds(t, &s->joint[k]);
  }
  for (int k = 0; k < s->n_drive; k++) {
    scene_check_drive(t, s, &s->drive[k]);
  }
  scene_check_lone(t, s);
}

/* ---- the whole */

/* Bodies on joints or springs; else one body alone. */
static int scene_is_system(const scene *s)
{
  return s->n_body > 1 || s->n_joint > 0 || s->n_spring > 0;
}

/* Speeds that a steady state has no use for. */
static void scene_check_trim(text_file *t, const scene *s)
{
  static const char why[] = "under trim: the steady state has its own";
  for (int b = 0; b < s->n_body && s->trim; b++) {
    const scene_body *const body = &s->body[b];
    const scene_joint *const joint = scene_joint_under(s, b);
    scene_refuse(t, &body->seen, "start_velocity", why);
    if (joint && joint->desc.kind == FB_JOINT_SPHERICAL) {
      scene_refuse(t, &body->seen, "start_spin", why);
    }
    for (int k = 0; k < FB_MAX_MODES; k++) {
      if (fabs(body->q_dot[k]) > 0) {
        t->line = scene_seen_numbered(&body->seen, "start_mode", k + 1);
        text_fail(t, "the rate of a mode %s", why);
      }
    }
  }
  for (int k = 0; k < s->n_joint && s->trim; k++) {
    for (int axis = 0; axis < 2; axis++) {
      const int line = scene_seen_numbered(&s->joint[k].seen, "speed", axis + 1);
      t->line = line > 0 ? line : t->line;
      if (line > 0) {
        text_fail(t, "a speed %s", why);
      }
    }
  }
  for (int k = 0; k < s->n_drive && s->trim; k++) {
    const scene_drive *const drive = &s->drive[k];
    const double rate = function_eval(&drive->f, &s->tables, 0, 0).rate;
    const int even = drive->f.kind == FUNCTION_RAMP || drive->f.kind == FUNCTION_TABLE;
    if (drive->kind == SCENE_VALUE && !even && fabs(rate) > 0) {
      t->line = drive->line;
      text_fail(t, "trim: no steady state: this value moves at 0 s, at a rate of %g that changes", rate);
    }
  }
}

/* Rotors are those of bodies with the effects of the momentum form. */
static void scene_check_rotors(text_file *t, const scene *s)
{
  for (int k = 0; k < s->n_rotor && !t->failed; k++) {
    const scene_body *const body = &s->body[s->rotor[k].body];
    t->line = s->rotor[k].text.line;
    if (s->is_exact) {
      text_fail(t, "a rotor is that of a body, not of an exact beam");
    }
    if (body->form.form != FB_FORM_MOMENTUM) {
      scene_refuse(t, &body->seen, "form", "of a body with rotors is momentum");
    }
  }
}

static void scene_check_events(text_file *t, const scene *s)
{
  for (int k = 0; k < s->n_event; k++) {
    if (s->event[k].t > s->duration) {
      t->line = s->event[k].line;
      text_fail(t, "an event at %g s: the duration is %g s", s->event[k].t, s->duration);
    }
  }
}

static void scene_check_measures(text_file *t, const scene *s)
{
  for (int k = 0; k < s->n_measure; k++) {
    const scene_measure *const m = &s->measure[k];
    t->line = m->line;
    if (m->kind < SCENE_FREQUENCY && m->after > s->duration) {
      text_fail(t, "after %g s: the duration is %g s", m->after, s->duration);
    }
  }
}

/* Their instants are told apart: those that are closer than 1e-9 of an interval are one. */
static void scene_check_controls(text_file *t, const scene *s)
{
  for (int k = 0; k < s->n_control; k++) {
    const scene_control *const c = &s->control[k];
    t->line = text_seen(&c->seen, "sample");
    if (c->sample < 1e-6 * s->interval) {
      text_fail(t, "a sample of %g s is below 1e-6 of the interval of %g s", c->sample, s->interval);
    }
    if (s->duration > 1e10 * c->sample) {
      text_fail(t, "a sample of %g s is there more than 1e10 times in the duration of %g s", c->sample, s->duration);
    }
  }
}

/* Names of all parameters, as many as fit. */
static const char *scene_parameter_names(const scene *s)
{
  static char names[400];
  int n = 0;
  names[0] = 0;
  for (int i = 0; i < s->n_parameter && n + TEXT_NAME + 2 < (int)sizeof names; i++) {
    n += snprintf(names + n, sizeof names - (size_t)n, "%s%s", i ? ", " : "", s->parameter[i].name);
  }
  return names;
}

/* Where everything stands that controllers remember. */
static void scene_lay_out(text_file *t, scene *s)
{
  int n = s->n_act + s->n_allocation;
  for (int k = 0; k < s->n_control; k++) {
    scene_control *const c = &s->control[k];
    c->acting = n;
    c->room = c->n_command * (2 * (int)ceil(c->delay / c->sample) + 8);
    c->orders = c->acting + c->n_command;
    c->references = c->orders + 3 * c->room;
    c->memory = c->references + c->shape_length * (c->attitude.is ? 2 * c->attitude.n_turn : c->n_signal);
    n = c->memory;
    for (int b = 0; b < c->n_block; b++) {
      c->block[b].at = n - c->memory;
      n += control_room(&c->block[b]);
    }
    if (n > SCENE_REMEMBERED) {
      t->line = c->line;
      text_fail(t,
                "controller %s and those before it remember %d numbers: states of blocks twice, delays and shapers; %d "
                "at most",
                c->name, n, SCENE_REMEMBERED);
      return;
    }
  }
  s->n_remembered = n;
}

static void scene_check_settings(text_file *t, const scene *s)
{
  for (int k = 0; k < s->n_set; k++) {
    int there = 0;
    for (int i = 0; i < s->n_parameter; i++) {
      there |= strcmp(s->set[k].name, s->parameter[i].name) == 0;
    }
    if (!there) {
      t->word = s->set[k].name;
      t->word_line = t->line;
      text_fail(t, "no parameter has the name %s, which is to be set; %s%s", s->set[k].name,
                s->n_parameter ? "there are: " : "the scene has none", scene_parameter_names(s));
    }
  }
}

/* What is thought to change something does. */
static void scene_check_parameters(text_file *t, const scene *s)
{
  for (int k = 0; k < s->n_parameter; k++) {
    if (!s->parameter[k].used) {
      t->line = s->parameter[k].line;
      text_fail(t, "nothing uses parameter %s: no number is $%s", s->parameter[k].name, s->parameter[k].name);
    }
  }
}

/* What chooses steps and modes knows no distributed loads. */
static void scene_check_distributed(text_file *t, const scene *s)
{
  int chosen = s->duration > 0 && !(s->step > 0);
  for (int k = 0; k < s->n_body; k++) {
    chosen |= s->body[k].tolerance > 0;
  }
  if (s->n_distributed > 0 && chosen) {
    t->line = s->distributed[0].line;
    text_fail(t, "distributed loads want a step, and bodies without auto");
  }
}

/* What only the whole file tells: first what has no line of its own. */
static void scene_check(text_file *t, scene *s)
{
  t->line = 0;
  if (s->n_body == 0) {
    text_fail(t, "a scene wants a body");
  }
  if (!(s->duration > 0) && !s->trim) {
    text_fail(t, "a scene wants a duration, or to trim");
  }
  for (int k = 0; k < s->n_body && !(s->duration > 0); k++) {
    scene_refuse(t, &s->body[k].seen, "auto", "wants a duration");
  }
  scene_check_settings(t, s);
  scene_check_distributed(t, s);
  if (!s->is_exact || !s->trim) {
    scene_refuse(t, &s->seen, "nudge", s->is_exact ? "wants trim" : "is that of an exact beam");
  }
  for (int k = 0; k < s->n_joint; k++) {
    s->joint[k].at += s->joint[k].loop ? s->n_body : 0;
  }
  if (s->is_exact && scene_is_system(s)) {
    text_fail(t, "an exact beam stands alone");
  }
  if (s->n_output == 0 && !t->failed) {
    scene_default_outputs(t, s);
  }
  s->interval = s->interval > 0 ? s->interval : s->duration / 1000;
  if (s->duration > 1e7 * s->interval) {
    text_fail(t, "more than 1e7 intervals of %g s", s->interval);
  }
  if (!t->failed) {
    (scene_is_system(s) ? scene_check_system : scene_check_single)(t, s);
    scene_check_rotors(t, s);
    scene_check_trim(t, s);
    scene_check_events(t, s);
    scene_check_measures(t, s);
    scene_check_controls(t, s);
    scene_lay_out(t, s);
    scene_check_parameters(t, s);
  }
}
#endif
