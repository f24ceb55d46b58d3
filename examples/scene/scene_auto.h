/* scene_auto.h - what a scene leaves to the program: the effects and modes of its bodies by fb_advice_solve, the
   integrator and its step. What happens at most is taken from a run of rigid bodies. See scene.h. */
#ifndef SCENE_AUTO_H
#define SCENE_AUTO_H
#include "scene_seen.h"

static const double scene_accuracy =
    1e-3; /* of the slowest mode at the end, where a step is chosen; exact beams: ten times */
/* [rad] of the fastest that acts, by integrator: of order 4 and 2 its integral errs by less than that */
static const double scene_part[] = {0.3, 0.1, 0.1, 0.3};
typedef char scene_parts_are_whole[sizeof scene_part / sizeof scene_part[0] == FB_INTEGRATOR_COUNT ? 1 : -1];

static long scene_rows(const scene *s)
{
  return s->duration > 0 ? (long)ceil(s->duration / s->interval * (1 - 1e-9)) : 0;
}

/* ---- bodies of the chosen effects and modes */

/* Built elsewhere, where all of it is written: scenes of several instances have room for bodies that are not there. */
static fb_status scene_body_init(int k, const fb_shape *shape, const fb_body_desc *level)
{
  static fb_body body;
  static fb_body_work work;
  const fb_status status = fb_body_init(&body, &work, shape, level);
  copy_memory(&engine.body[k], &body, sizeof body);
  return status;
}

static fb_status scene_init_body(const scene *s, int k, const fb_advice *advice)
{
  static fb_shape selected;
  const scene_body *const b = &s->body[k];
  fb_body_desc level = b->level;
  fb_status status = FB_OK;
  for (int a = 0; a < FB_MAX_MODES; a++) {
    engine.place[k][a] = advice ? -1 : a;
  }
  if (advice) {
    status = fb_shape_select(&selected, &b->shape, advice->coordinate, advice->n);
    level.effects = advice->effects;
    for (int a = 0; a < advice->n; a++) {
      engine.place[k][advice->coordinate[a]] = a;
      level.zeta[a] = b->level.zeta[advice->coordinate[a]];
    }
  }
  level.allow_long_step = advice && advice->long_step;
  if (scene_is_system(s)) {
    level.base = FB_BASE_PRESCRIBED;
  }
  status = status ? status : scene_body_init(k, advice ? &selected : &b->shape, &level);
  if (status == FB_OK && b->form.form != FB_FORM_MOMENTUM) {
    const fb_form_desc form = {b->form.form, b->form.stiffness_torque, &b->torque};
    status = fb_form_init(&engine.formed, &engine.body_work, &b->shape, &level, &form);
  }
  engine.is_formed = b->form.form != FB_FORM_MOMENTUM;
  return status;
}

/* ---- the most that happens, by rigid bodies */

static struct scene_auto {
  fb_envelope envelope[FB_MAX_BODIES];
  fb_advice advice[FB_MAX_BODIES];
  fb_advice_work work;
  double spin, acceleration; /* largest of all bodies [rad/s], [m/s^2] */
  int doubted;               /* no such run is to be believed: all this is of the start */
} automatic;

/* x takes the value that is farther from zero. */
static void scene_widen(fb_real *x, fb_real value)
{
  *x = FB_FABS(value) > FB_FABS(*x) ? value : *x;
}

static fb_status scene_build_rigid(const scene *s)
{
  fb_status status = FB_OK;
  engine.is_formed = 0;
  for (int k = 0; k < s->n_body && status == FB_OK; k++) {
    fb_body_desc level = s->body[k].level;
    level.effects &= FB_EFFECT_GRAVITY;
    memset(level.zeta, 0, sizeof level.zeta);
    level.base = scene_is_system(s) ? FB_BASE_PRESCRIBED : level.base;
    level.allow_long_step = 1;
    for (int a = 0; a < FB_MAX_MODES; a++) {
      engine.place[k][a] = -1;
    }
    status = scene_body_init(k, &s->body[k].shape, &level);
  }
  return status;
}

/* What something connected to a node does to its body, inertial axes: the most in the body's axes. */
static void scene_note_load(const scene *s, int body, int node, const fb_real force[3], const fb_real torque[3])
{
  fb_envelope *const e = body == FB_GROUND ? NULL : &automatic.envelope[body];
  fb_real R[9], own[3], turn[3];
  int k = s->n_load; /* loads of the scene come first, then one place for each node */
  if (!e || s->body[body].shape.n == 0) {
    return;
  }
  while (k < e->n_load && e->load[k].node != node) {
    k++;
  }
  if (k >= FB_MAX_LOADS) {
    return;
  }
  if (k == e->n_load) {
    e->n_load++;
    e->load[k].node = node;
    e->load[k].axes = FB_AXES_BODY;
  }
  fb_quat_to_mat33(R, engine.view.motion.pose[body].quat);
  fb_mat33_mulT_vec3(own, R, force);
  fb_mat33_mulT_vec3(turn, R, torque);
  for (int i = 0; i < 3; i++) {
    scene_widen(&e->load[k].force[i], own[i]);
    scene_widen(&e->load[k].torque[i], turn[i]);
  }
}

/* What a joint does to the body that carries it: minus its load on the child. */
static void scene_note_joint(const scene *s, const scene_joint *joint)
{
  const fb_joint_motion *const m = &engine.view.motion.joint[joint->at];
  fb_real force[3], torque[3];
  for (int i = 0; i < 3; i++) {
    force[i] = -m->force[i];
    torque[i] = -m->torque[i];
  }
  scene_note_load(s, joint->desc.parent, joint->desc.parent_node, force, torque);
}

/* What a spring does to the nodes of both its ends. */
static fb_status scene_note_spring(const scene *s, int j)
{
  const fb_spring *const spring = &s->spring[j].desc;
  const fb_spring_motion *const at = &engine.view.motion.spring[j];
  fb_real x[2][3];
  const fb_status status = scene_spring_points(x, s, j);
  for (int side = 0; side < 2 && status == FB_OK && at->length > 0; side++) {
    fb_real force[3], arm[3], torque[3], R[9];
    for (int i = 0; i < 3; i++) {
      force[i] = at->tension / at->length * (x[1 - side][i] - x[side][i]);
    }
    if (spring->body[side] >= 0) { /* the body is rigid here: its sections are turned as the body */
      fb_quat_to_mat33(R, engine.view.motion.pose[spring->body[side]].quat);
      fb_mat33_mul_vec3(arm, R, spring->position[side]);
      fb_vec3_cross(torque, arm, force);
      scene_note_load(s, spring->body[side], spring->node[side], force, torque);
    }
  }
  return status;
}

static void scene_note_body(const scene *s, int k)
{
  const fb_motion *const m = &engine.view.motion.motion[k];
  fb_envelope *const e = &automatic.envelope[k];
  const int held = scene_is_system(s) || s->body[k].level.base == FB_BASE_PRESCRIBED;
  fb_real R[9], size = 0, felt = 0;
  fb_quat_to_mat33(R, engine.view.motion.pose[k].quat);
  for (int i = 0; i < 3; i++) {
    fb_real a = held ? m->acceleration[i] : 0;
    for (int j = 0; j < 3; j++) {
      a -= R[3 * j + i] * s->body[k].level.gravity[j];
    }
    scene_widen(&e->acceleration[i], a);
    scene_widen(&e->spin[i], m->w[i]);
    if (held) {
      scene_widen(&e->velocity[i], m->v[i]);
      scene_widen(&e->spin_rate[i], m->w_dot[i]);
    }
    size += m->w[i] * m->w[i];
    felt += a * a;
  }
  automatic.spin = scene_is_system(s) ? automatic.spin : fmax(automatic.spin, sqrt((double)size));
  automatic.acceleration = fmax(automatic.acceleration, sqrt((double)felt));
}

/* Momenta of rotors, and torques of their motors. */
static void scene_note_drives(const scene *s, double t)
{
  for (int k = 0; k < s->n_rotor; k++) {
    const scene_rotor *const rotor = &s->rotor[k];
    fb_rotor_input *const most = &automatic.envelope[rotor->body].rotor[rotor->at];
    scene_widen(&most->torque, scene_rotor_at(s, rotor, t, t + timing.slack).torque);
    scene_widen(&most->momentum, engine.view.motion.motion[rotor->body].rotor_momentum[rotor->at]);
  }
}

static void scene_note_loads(const scene *s, double t)
{
  for (int k = 0; k < s->n_load; k++) {
    fb_envelope *const e = &automatic.envelope[s->load[k].body];
    const fb_load load = scene_load_at(s, &s->load[k], t, t + timing.slack);
    e->load[k].node = load.node;
    e->load[k].axes = load.axes == FB_AXES_INERTIAL ? FB_AXES_BODY : load.axes;
    for (int i = 0; i < 3; i++) { /* a dead load may come from anywhere: it is taken as it stands at the start */
      scene_widen(&e->load[k].force[i], load.force[i]);
      scene_widen(&e->load[k].torque[i], load.torque[i]);
    }
  }
}

/* [rad/s] of what drives the scene; HUGE_VAL: a jump. */
static double scene_frequency(const scene *s)
{
  const function *f;
  double frequency = 0;
  int starts = s->n_load > 0;
  for (int k = 0; k < s->n_body; k++) {
    starts |= (s->body[k].level.effects & FB_EFFECT_GRAVITY) != 0;
  }
  for (int k = 0; (f = scene_function(s, k)) != NULL; k++) {
    frequency = fmax(frequency, function_frequency(f, &s->tables));
    starts &= k >= s->n_load || f->kind == FUNCTION_CONSTANT;
  }
  if (starts && !s->trim) {
    return HUGE_VAL; /* it falls onto an undeformed body */
  }
  return s->n_event > 0 || s->n_control > 0 ? HUGE_VAL
                                            : fmax(frequency, starts || scene_is_system(s) ? automatic.spin : 0);
}

#define SCENE_RIGID_ROWS 2000 /* at most, and.. */
#define SCENE_RIGID_STEPS 1e5 /* ..about so many steps, of the run of rigid bodies */

/* Forgets what was noted. */
static void scene_note_nothing(const scene *s)
{
  memset(automatic.envelope, 0, sizeof automatic.envelope);
  for (int k = 0; k < s->n_body; k++) {
    automatic.envelope[k].n_load = s->n_load; /* those of other bodies stay zero */
  }
  automatic.spin = automatic.acceleration = 0;
  seen_note_nothing();
}

/* The rotation that the steps of a body with rotors are to resolve: their nutation. */
static fb_status scene_note_rotors(void)
{
  fb_body_limit limit;
  const fb_status status = fb_body_limit_eval(&engine.body[0], &limit, &engine.state, &engine.at[0]);
  automatic.spin = status == FB_OK ? fmax(automatic.spin, (double)limit.spin) : automatic.spin;
  return status;
}

/* The rotation that the steps of a system are to resolve: that of rotors is not. */
static fb_status scene_note_spin(void)
{
  fb_system_limit limit;
  const fb_status status = fb_system_limit_eval(&engine.system, engine.body, &engine.system_work, &limit,
                                                &engine.system_state, &engine.system_at[0]);
  automatic.spin = status == FB_OK ? fmax(automatic.spin, (double)limit.spin) : automatic.spin;
  return status;
}

static fb_status scene_note(const scene *s, double t)
{
  fb_status status = scene_look(s, t);
  status = status == FB_OK && scene_is_system(s) ? scene_note_spin() : status;
  status = status == FB_OK && !scene_is_system(s) && s->n_rotor > 0 ? scene_note_rotors() : status;
  for (int b = 0; b < s->n_body && status == FB_OK; b++) {
    scene_note_body(s, b);
  }
  for (int j = 0; j < s->n_joint && status == FB_OK; j++) {
    scene_note_joint(s, &s->joint[j]);
  }
  for (int j = 0; j < s->n_spring && status == FB_OK; j++) {
    status = scene_note_spring(s, j);
  }
  for (int k = 0; k < s->n_output && status == FB_OK; k++) {
    const scene_quantity what = s->output[k].quantity;
    if (what != SCENE_INTERNAL_FORCE && what != SCENE_INTERNAL_MOMENT) { /* rigid bodies have none */
      seen_note(s, k, scene_value(s, &s->output[k]));
    }
  }
  if (status == FB_OK) {
    scene_note_drives(s, t);
  }
  scene_note_loads(s, t);
  return status;
}

/* Steps of the piece from *t on, each noted; *t is its end. */
static fb_status scene_take_rigid(const scene *s, long row, double *t, int *event)
{
  fb_status status = scene_note(s, *t);
  scene_piece p;
  status = status ? status : scene_happen(s, event, *t);
  p = scene_piece_from(s, (double)row * timing.interval, (double)(row + 1) * timing.interval, *t);
  for (long k = 0; (double)k < p.steps && status == FB_OK; k++) {
    const double at = p.begin + (double)k * p.dt;
    status = k > 0 ? scene_note(s, at) : FB_OK;
    status = status ? status : scene_step(s, at, p.dt);
  }
  *t = p.end;
  return status;
}

/* In steps of dt [s] at most, by SDIRK where joints are too stiff for rk4. What it notes needs another run to be
   believed where a step is long for springs, dampers or the spin: *rough. */
static fb_status scene_run_rigid_once(const scene *s, double dt, int *rough)
{
  int event = 0;
  fb_status status;
  scene_note_nothing(s);
  engine.integrator = FB_INTEGRATOR_RK4;
  engine.by_step = 0;
  timing.longest = dt;
  status = scene_start(s);
  if (status == FB_OK && scene_is_system(s) && !(dt < (double)fb_system_rk4_limit(&engine.system, engine.body, 0, 0))) {
    engine.integrator = FB_INTEGRATOR_SDIRK;
  }
  for (long row = 0; row < timing.rows && status == FB_OK; row++) {
    double t = (double)row * timing.interval;
    while (t < (double)(row + 1) * timing.interval && status == FB_OK) {
      status = scene_take_rigid(s, row, &t, &event);
    }
  }
  status = status ? status : scene_note(s, s->duration);
  *rough = engine.integrator == FB_INTEGRATOR_SDIRK || automatic.spin * dt > 1;
  return status;
}

/* Roughly: what diverges differs by powers of ten, what is too fast for the step, and damped, does not. */
static int scene_agree(double a, double b)
{
  return fmax(a, b) <= 4 * fmin(a, b);
}

/* Runs rigid bodies, again with shorter steps where two runs are to agree; else what is noted is the start. */
static void scene_run_rigid(const scene *s)
{
  double spin = -1, acceleration = -1, dt;
  int rough = 0, believed = 0;
  fb_status status = scene_build_rigid(s);
  scene_clock_init(s, (long)fmin(SCENE_RIGID_ROWS, (double)scene_rows(s)));
  timing.part = fmax(0.5, scene_fastest(s) * s->duration / SCENE_RIGID_STEPS);
  engine.long_step = 1;
  dt = timing.interval / 4;
  for (int k = 0; k < 3 && status == FB_OK && !believed; k++, dt /= 2) {
    believed = scene_run_rigid_once(s, dt, &rough) == FB_OK &&
               (!rough || (scene_agree(automatic.spin, spin) && scene_agree(automatic.acceleration, acceleration)));
    spin = automatic.spin;
    acceleration = automatic.acceleration;
  }
  automatic.doubted = !believed;
  if (!believed) {
    scene_note_nothing(s);
    status = status ? status : scene_start(s);
    status = status ? status : scene_note(s, 0);
  }
  engine.long_step = 0;
}

/* ---- advice on the bodies that ask for it */

static void scene_tell_advice(const scene *s, int k, FILE *talk)
{
  static const char *const name[FB_ADVICE_EFFECTS] = {"elastic", "spin_coupling", "residual_inertia", "spin_stiffening",
                                                      "acceleration_stiffening"};
  const fb_advice *const a = &automatic.advice[k];
  fprintf(talk, "%s: %d of %d modes, effects:", s->body[k].name, a->n, s->body[k].shape.n);
  for (int i = 0; i < FB_ADVICE_EFFECTS; i++) {
    if (a->effects & (1u << i)) {
      fprintf(talk, " %s", name[i]);
    }
  }
  fprintf(talk, "%s%s%s\n  estimated error %.2g %% of %.3g m, allowed %.2g %%; by leaving out",
          a->effects & FB_EFFECT_LARGE_DEFLECTION ? " large_deflection" : "",
          a->effects & FB_EFFECT_DAMPING ? " damping" : "", a->effects & FB_EFFECT_GRAVITY ? " gravity" : "",
          100 * (double)a->error, (double)a->deflection, 100 * s->body[k].tolerance);
  for (int i = 1; i < FB_ADVICE_EFFECTS; i++) {
    fprintf(talk, "%s %s: %.2g %%", i > 1 ? "," : "", name[i], 100 * (double)a->without[i]);
  }
  if (a->effects & FB_EFFECT_LARGE_DEFLECTION) {
    fprintf(talk, ", large_deflection: %.2g %%", 100 * (double)a->error_field);
  }
  fputs("\n", talk);
}

/* The chosen effects and modes are the best there are, and not good enough. */
static void scene_tell_missed(scene *s, int k, FILE *warn)
{
  const fb_advice *const a = &automatic.advice[k];
  s->missed++;
  scene_warn(
      s, warn,
      "auto of body %s: estimated error %.3g %%, beyond the allowed %.3g %% (of effects %.2g, modes %.2g, step %.2g, "
      "of what no modal body has %.2g)  MISSED",
      s->body[k].name, 100 * (double)a->error, 100 * s->body[k].tolerance, 100 * (double)a->error_effects,
      100 * (double)a->error_modes, 100 * (double)a->error_step, 100 * (double)a->error_model);
}

/* Effects and modes of body k. */
static int scene_advise(scene *s, int k, FILE *talk)
{
  const scene_body *const b = &s->body[k];
  fb_envelope *const e = &automatic.envelope[k];
  fb_body_desc level = b->level;
  const double frequency = scene_frequency(s);
  fb_status status;
  level.effects |= FB_EFFECTS_FULL;
  level.base = scene_is_system(s) ? FB_BASE_PRESCRIBED : level.base;
  e->frequency = frequency < HUGE_VAL ? (fb_real)frequency : FB_HUGE;
  e->duration = (fb_real)s->duration;
  e->node = b->n_node - 1;
  status = fb_advice_solve(&automatic.advice[k], &automatic.work, &b->shape, &level, e, (fb_real)b->tolerance);
  if (status != FB_OK) {
    return scene_fail_at(s, b->line, "body %s: no advice by auto: %s", b->name,
                         status == FB_ERR_VALUE ? "nothing that acts moves its last node" : refusal_text(status));
  }
  if (talk) {
    scene_tell_advice(s, k, talk);
  }
  return 0;
}

/* ---- integrator and step */

/* Longest step [s] that the integrator takes. */
static double scene_limit(const scene *s, fb_integrator integrator)
{
  const fb_real w = (fb_real)automatic.spin, a = (fb_real)automatic.acceleration;
  if (scene_is_system(s)) {
    return integrator == FB_INTEGRATOR_SDIRK ? 0.1 / automatic.spin
                                             : (double)fb_system_rk4_limit(&engine.system, engine.body, w, a);
  }
  return (double)(integrator == FB_INTEGRATOR_RK4           ? fb_rk4_limit(&engine.body[0], w, a)
                  : integrator == FB_INTEGRATOR_EXPONENTIAL ? fb_exponential_limit(&engine.body[0], w, a)
                                                            : fb_implicit_limit(&engine.body[0], w, a));
}

/* At most dt, and so short that the modes that an output sees err by scene_accuracy of its range. */
static double scene_resolve(const scene *s, fb_integrator integrator, double dt)
{
  static fb_real amplitude[FB_MAX_LINEAR];
  for (int k = 0; k < s->n_output && integrator != FB_INTEGRATOR_EXPONENTIAL; k++) {
    if (seen_amplitudes(amplitude, s, k, 1)) {
      const double fits = (double)fb_spectrum_dt(&engine.spectrum, integrator, amplitude, (fb_real)s->duration,
                                                 (fb_real)scene_accuracy);
      dt = fits > 0 ? fmin(dt, fits) : dt;
    }
  }
  return dt;
}

/* A step of an integrator: modes by their weight in a static deflection, (w_1/w_k)^2, from the first on that moves to
   and fro in the run: what is slower drifts, like rigid motion, whose zeros rounding moves. A turn of the whole
   resolved; then what the outputs see. */
static double scene_step_of(const scene *s, fb_integrator integrator, int has_spectrum)
{
  static fb_real amplitude[FB_MAX_LINEAR];
  const double turn =
      (integrator == FB_INTEGRATOR_RK4 || integrator == FB_INTEGRATOR_EXPONENTIAL ? 0.03 : 0.01) / automatic.spin;
  const double limit = scene_limit(s, integrator);
  double lowest = 0, dt = fmin(fmin(s->interval, turn), 0.8 * limit);
  for (int k = 0; k < engine.spectrum.n && has_spectrum; k++) {
    const double w = (double)engine.spectrum.im[k];
    lowest = lowest > 0 || !(w * s->duration > 1) ? lowest : w;
    amplitude[k] = (fb_real)(lowest > 0 && w > 0 ? lowest * lowest / (w * w) : 0);
  }
  if (lowest > 0 && integrator != FB_INTEGRATOR_EXPONENTIAL) {
    const double fits =
        (double)fb_spectrum_dt(&engine.spectrum, integrator, amplitude, (fb_real)s->duration, (fb_real)scene_accuracy);
    return scene_resolve(s, integrator, fits > 0 ? fmin(dt, fits) : dt);
  }
  return has_spectrum ? dt : fmin(dt, 0.2 * limit);
}

/* Does the integrator step the only body at all? Large deflection may be refused: one short step tells, which leaves the
   start of the scene as it is. */
static int scene_takes(const scene *s, fb_integrator integrator)
{
  static fb_state start;
  fb_status status;
  if (scene_is_system(s) || !(engine.body[0].effects & FB_EFFECT_LARGE_DEFLECTION)) {
    return 1;
  }
  start = engine.state;
  status = fb_state_init(&engine.body[0], &engine.state);
  status = status ? status
                  : body_stepper(&engine.by, &engine.exponential, &engine.body_work, &engine.body[0], &engine.state,
                                 engine.at, integrator, 1e-6 * s->interval);
  status = status ? status : fb_stepper_step(&engine.by);
  engine.by_step = 0;
  engine.state = start;
  return status != FB_ERR_UNSUPPORTED;
}

/* Is the integrator one to choose from? The stiffness torque of the first-order form is explicit in implicit
   integrators. */
static int scene_may_choose(const scene *s, fb_integrator integrator)
{
  if (!s->integrator_auto) {
    return integrator == s->integrator;
  }
  if (!scene_takes(s, integrator)) {
    return 0;
  }
  return integrator == FB_INTEGRATOR_RK4 ||
         (s->body[0].form.form != FB_FORM_FIRST &&
          (integrator == FB_INTEGRATOR_SDIRK || (integrator == FB_INTEGRATOR_MIDPOINT && !scene_is_system(s))));
}

/* Integrator and step where they are not asked for. */
static void scene_choose(scene *s)
{
  static const double work[FB_INTEGRATOR_COUNT] = {4, 7, 11, 4}; /* evaluations; twice as many where the order is 2 */
  const fb_advice *const advice = &automatic.advice[0];
  double least = HUGE_VAL;
  int has_spectrum;
  s->dt = s->step;
  engine.integrator = s->integrator_auto ? FB_INTEGRATOR_RK4 : s->integrator;
  if (s->is_exact) {
    s->dt = s->step > 0 ? s->step : exact_choose(s, 10 * scene_accuracy);
    return;
  }
  has_spectrum = scene_spectrum(s) == FB_OK;
  scene_see(s, has_spectrum);
  if (s->step > 0) {
    return;
  }
  if (s->n_rotor > 0) {
    (void)(scene_is_system(s) ? scene_note_spin() : scene_note_rotors());
  }
  if (!scene_is_system(s) && s->body[0].tolerance > 0 && (s->integrator_auto || s->integrator == advice->integrator)) {
    engine.integrator = advice->integrator;
    s->dt = scene_resolve(s, engine.integrator, fmin(s->interval, (double)advice->dt));
  } else {
    for (int integrator = 0; integrator < (int)FB_INTEGRATOR_COUNT; integrator++) {
      const int tried = scene_may_choose(s, (fb_integrator)integrator);
      const double dt = tried ? scene_step_of(s, (fb_integrator)integrator, has_spectrum) : 0;
      if (tried && work[integrator] / dt < least) {
        least = work[integrator] / dt;
        engine.integrator = (fb_integrator)integrator;
        s->dt = dt;
      }
    }
  }
}
#endif
