/* system.c - random legal systems: bodies on every kind of joint, loops, springs, and the laws that they keep. */
#include "laws.h"

static const fbl_feature features[] = {
    {"bodies", {"one", "two", "three", "four", "five"}},
    {"tree", {"chain", "star", "mixed"}},
    {"at", {"hub", "tip"}},
    {"root", {"free", "rigid", "revolute", "spherical", "driven"}},
    {"joint",
     {"revolute", "prismatic", "cylindrical", "screw", "universal", "spherical", "rigid", "free", "all"}},
    {"mode", {"free", "locked", "prescribed", "some"}},
    {"effort", {"none", "spring", "motor", "friction", "stop"}},
    {"loop", {"none", "ball", "hinge", "several", "planar"}},
    {"spring", {"none", "between", "ground", "pull"}},
    {"frame", {"plain", "turned", "axis"}},
    {"body", {"solid", "full", "rigid", "linear", "spin", "large", "mixed"}},
    {"made", {"beam", "offset", "lumps", "import", "welded", "two"}},
    {"rotors", {"none", "hub", "boom", "rubbing", "unbalanced", "given"}},
    {"gravity", {"none", "uniform", "center"}},
    {"damping", {"none", "damped"}},
    {"load", {"none", "dead", "follower", "hub", "distributed"}},
    {"wheel", {"none", "wheel"}},
    {"motion", {"slow", "spinning", "flight"}},
    {"method", {"recursive", "dense", "multipliers"}},
    {"callback", {"none", "forces", "rows"}},
};
enum {
  BODIES,
  TREE,
  AT,
  ROOT,
  JOINT,
  MODE,
  EFFORT,
  LOOP,
  SPRING,
  FRAME,
  BODY,
  MADE,
  ROTORS,
  GRAVITY,
  DAMPING,
  LOAD,
  WHEEL,
  MOTION,
  METHOD,
  CALLBACK,
  N_FEATURE
};
enum { ON_HUB = 0, ON_TIP };
enum { ROOT_FREE, ROOT_RIGID, ROOT_REVOLUTE, ROOT_SPHERICAL, ROOT_DRIVEN };
enum { ALL_JOINTS = 8, FREE_JOINTS = 7 };
enum { SOME_MODES = 3 };
enum { NO_EFFORT, SPRUNG, MOTOR, FRICTION, STOP };
enum { NO_LOOP, BALL, HINGE, SEVERAL, PLANAR };
enum { NO_SPRING, BETWEEN, TO_GROUND, PULL };
enum { PLAIN, TURNED, BY_AXIS };
enum { SOLID, FULL, COUPLED, LINEAR, SPIN, LARGE, MIXED };
enum { BEAM, OFFSET_BEAM, WITH_LUMPS, IMPORTED, WELDED, TWO_BEAMS };
enum { NO_LOAD, DEAD, FOLLOWER, BODY_LOAD, DISTRIBUTED };
enum { SLOW, SPINNING, FLIGHT };
enum { NO_CALLBACK, FORCES, ROWS };
typedef char one_name_each[FBL_COUNT(features) == N_FEATURE ? 1 : -1];

enum { MODELS = 3, BEAMS = 5, BODIES_MOST = BEAMS + 1 };

/* ---- the scene, bodies and joints by the numbers of the scene; slot: those that the system has */

static int now[FBL_FEATURES];
static fb_body made[MODELS + 1]; /* by bodies of the scene: k % MODELS, the wheel last */
static double size_made[MODELS + 1];
static fb_body model[MODELS + 1]; /* in the order of the system */
static int model_slot[MODELS + 1], n_model;
static int n_body, parent[BODIES_MOST], slot[BODIES_MOST], body_of[BODIES_MOST];
static fb_joint_kind kind[BODIES_MOST];
static fb_system_desc desc;
static fb_system mechanism;
static fb_system_work work;
static fb_system_state state; /* where the motion starts */
static fb_link_motion start[BODIES_MOST];
static fb_row held; /* the caller's constraint */
static double size;

/* Axes: their number, which of them slides. */
static int axes_of(fb_joint_kind k)
{
  static const int n[FB_JOINT_COUNT] = {6, 0, 1, 1, 2, 1, 2, 3};
  return n[k];
}

static int slides(fb_joint_kind k, int axis)
{
  return k == FB_JOINT_PRISMATIC || (k == FB_JOINT_CYLINDRICAL && axis == 1);
}

static int is_ball(fb_joint_kind k)
{
  return k == FB_JOINT_FREE || k == FB_JOINT_SPHERICAL;
}

/* x of axis i of a joint as it is seen: an angle about z or x turns the other way in the mirror. */
static fb_real seen_axis(fb_joint_kind k, int i, double x, int kg, int s)
{
  const int slide = slides(k, i);
  const double sign = fbl_seen.mirror && !slide && !(k == FB_JOINT_SPHERICAL && i == 1) ? -1.0 : 1.0;
  return fbl_unit(sign * x, kg, slide ? (kg ? 1 : 1) : (kg ? 2 : 0), s);
}

/* Effects of beam k. */
static int effects_of(const int *level, int k)
{
  static const int mixed[] = {FBL_FULL, FBL_RIGID, FBL_FULL};
  switch (level[BODY]) {
  case MIXED:
    return mixed[k % MODELS];
  default:
    return level[BODY] - 1;
  }
}

static int is_solid(const int *level, int k)
{
  return level[BODY] == SOLID || (level[BODY] == MIXED && k % MODELS == 2);
}

static int bodies_of(const int *level)
{
  return level[BODIES] + 1;
}

static int parent_of(const int *level, int k)
{
  return level[TREE] == 0 ? k - 1 : level[TREE] == 1 ? 0 : (k - 1) / 2;
}

static fb_joint_kind kind_of(const int *level, int k)
{
  static const fb_joint_kind root[] = {FB_JOINT_FREE, FB_JOINT_RIGID, FB_JOINT_REVOLUTE, FB_JOINT_SPHERICAL, FB_JOINT_FREE};
  static const fb_joint_kind other[] = {FB_JOINT_REVOLUTE, FB_JOINT_PRISMATIC, FB_JOINT_CYLINDRICAL,
                                        FB_JOINT_SCREW,    FB_JOINT_UNIVERSAL, FB_JOINT_SPHERICAL,
                                        FB_JOINT_RIGID,    FB_JOINT_FREE};
  if (k == 0) {
    return root[level[ROOT]];
  }
  return other[level[JOINT] == ALL_JOINTS ? (3 * k + 1) % 7 : level[JOINT]];
}

static fb_axis_mode mode_of(const int *level, int k, int axis)
{
  if (k == 0) {
    return level[ROOT] == ROOT_DRIVEN ? FB_AXIS_PRESCRIBED : FB_AXIS_FREE;
  }
  if (kind_of(level, k) == FB_JOINT_FREE || axis >= axes_of(kind_of(level, k))) {
    return FB_AXIS_FREE;
  }
  return (fb_axis_mode)(level[MODE] == SOME_MODES ? (k + axis + 1) % 3 : level[MODE]);
}

static int is_grounded(const int *level)
{
  return level[ROOT] >= ROOT_RIGID && level[ROOT] <= ROOT_SPHERICAL;
}

/* ---- loops: between the last body and the ground, or the first one */

static int loops_of(const int *level)
{
  return level[LOOP] == NO_LOOP ? 0 : level[LOOP] == SEVERAL ? 2 : 1;
}

static fb_joint_kind loop_kind(const int *level, int l)
{
  static const fb_joint_kind one[] = {FB_JOINT_FREE, FB_JOINT_SPHERICAL, FB_JOINT_REVOLUTE, FB_JOINT_CYLINDRICAL,
                                      FB_JOINT_REVOLUTE};
  return l == 0 ? one[level[LOOP]] : FB_JOINT_UNIVERSAL;
}

static void loop_ends(const int *level, int l, int *from, int *to)
{
  const int last = bodies_of(level) - 1;
  *to = l == 0 ? last : last - 1;
  *from = is_grounded(level) || level[ROOT] == ROOT_DRIVEN ? FB_GROUND : 0;
  if (level[TREE] == 1 && *from == 0) {
    *from = l == 0 ? last - 1 : 1;
  }
}

/* Free axes of the joints on the way from a body to the ground (a free root counts none), each once. */
static int freedom(const int *level)
{
  int n = 0, used[BODIES_MOST] = {0};
  for (int l = 0; l < loops_of(level); l++) {
    int end[2];
    loop_ends(level, l, &end[0], &end[1]);
    for (int e = 0; e < 2; e++) {
      for (int k = end[e]; k >= 0; k = k == 0 ? FB_GROUND : parent_of(level, k)) {
        for (int i = 0; i < axes_of(kind_of(level, k)) && !used[k]; i++) {
          n += (k > 0 || is_grounded(level)) && mode_of(level, k, kind_of(level, k) == FB_JOINT_SPHERICAL ? 0 : i) == FB_AXIS_FREE;
        }
        used[k] = 1;
      }
    }
    n -= 6 - axes_of(loop_kind(level, l));
  }
  return n;
}

static void choose(fbl_choice *c, const int *level, int k)
{
  memset(c, 0, sizeof *c);
  c->effects = effects_of(level, k) < 0 ? 0 : effects_of(level, k);
  c->section = level[MADE] == OFFSET_BEAM ? FBL_OFFSET : k == 1 ? FBL_TAPER : FBL_UNIFORM;
  c->modes = k == 1 ? FBL_TORSION : FBL_BOTH;
  c->lumps = level[MADE] == WITH_LUMPS ? FBL_SEVERAL : FBL_NO_LUMP;
  c->import = level[MADE] == IMPORTED ? (k == 1 ? FBL_LUMPS : FBL_PARTICLES) : FBL_NO_IMPORT;
  c->parts = level[MADE] == WELDED ? FBL_WELDED : level[MADE] == TWO_BEAMS ? FBL_TWO_BEAMS : FBL_ONE_BEAM;
  c->basis = level[AT] == ON_TIP && level[MADE] < IMPORTED ? FBL_COMPONENT : FBL_NATURAL;
  c->rotors = k == 0 ? level[ROTORS] : FBL_NO_ROTOR;
  c->gravity = level[GRAVITY];
  c->damping = level[DAMPING];
  c->hub = k == 2 ? 2 : 0;
  fbl_legal(c);
}

static void legal(int *level)
{
  const int n = bodies_of(level);
  if (n == 1) {
    level[TREE] = level[AT] = level[JOINT] = level[MODE] = 0;
    level[EFFORT] = level[ROOT] == ROOT_FREE || level[ROOT] == ROOT_DRIVEN ? NO_EFFORT : level[EFFORT];
  }
  if (level[LOOP] == PLANAR && (n < 3 || !is_grounded(level))) {
    level[LOOP] = HINGE;
  }
  if (level[LOOP] == PLANAR) { /* four bars and what hangs on them, redundant */
    level[ROOT] = ROOT_REVOLUTE;
    level[TREE] = level[JOINT] = level[MODE] = level[BODY] = level[FRAME] = 0;
  }
  level[LOOP] = level[LOOP] == SEVERAL && n < 3 ? BALL : n < 2 ? NO_LOOP : level[LOOP];
  while (level[LOOP] != NO_LOOP && level[LOOP] != PLANAR && freedom(level) < 1) {
    level[LOOP]--;
  }
  if (level[BODY] == SOLID) {
    level[MADE] = level[ROTORS] = level[DAMPING] = 0;
  }
  if (level[LOAD] == DISTRIBUTED && level[BODY] != LARGE) {
    level[LOAD] = DEAD;
  }
  if (level[GRAVITY] == FBL_CENTER && (level[BODY] == LINEAR || level[BODY] == SPIN)) {
    level[GRAVITY] = FBL_GRAVITY;
  }
  if (level[ROOT] != ROOT_FREE && level[CALLBACK] == ROWS) { /* what the plane is for may have no other way to go */
    level[CALLBACK] = NO_CALLBACK;
  }
  if (level[ROOT] != ROOT_FREE && level[MOTION] == FLIGHT) {
    level[MOTION] = SPINNING;
  }
}

/* ---- bodies */

static fb_body_work body_work;
static fb_shape shape;

/* A rigid body: nodes 1 and 2 off its center; round: a wheel about z. */
static fb_status solid_make(fb_body *body, const int *level, int round, double *reach)
{
  static fb_body_desc d;
  const double mass = round ? 1.0 : fbl_in(1.0, 10.0), long_ = round ? 0.3 : fbl_in(0.5, 1.5);
  fb_real center[3], at[3], inertia[6] = {0};
  int node;
  fb_status status = fb_shape_init(&shape, 0);
  memset(&d, 0, sizeof d);
  *reach = long_;
  fbl_polar(center, round ? 0.0 : fbl_in(0.1, 0.3), round ? 0.0 : fbl_in(-0.2, 0.2), round ? 0.0 : fbl_in(-0.2, 0.2), 0, 1, 0);
  for (int i = 0; i < 3; i++) {
    inertia[i] = fbl_unit(mass * long_ * long_ * (round ? (i == 2 ? 0.5 : 0.3) : fbl_in(0.15, 0.25)), 1, 2, 0);
  }
  if (!round) {
    inertia[3] = fbl_unit((fbl_seen.mirror ? -1.0 : 1.0) * 0.02 * mass * long_ * long_, 1, 2, 0);
  }
  status = status ? status : fb_shape_add_rigid(&shape, fbl_unit(mass, 1, 0, 0), center, inertia);
  fbl_polar(at, long_, 0.1, -0.2, 0, 1, 0);
  status = status ? status : fb_shape_add_node(&shape, &node, at, NULL, NULL);
  fbl_stream("gravity of solids");
  d.effects = FB_EFFECTS_RIGID;
  if (level[GRAVITY] == FBL_GRAVITY) {
    d.effects |= FB_EFFECT_GRAVITY;
    fbl_inertial_polar(d.gravity, 1.0, 0.5, -3.0, 0, 1, -2);
  }
  if (level[GRAVITY] == FBL_CENTER) {
    d.mu = fbl_unit(2e5, 0, 3, -2);
    fbl_inertial_polar(d.center, 90.0, -100.0, 70.0, 0, 1, 0);
    for (int i = 0; i < 3; i++) {
      d.center[i] += fbl_unit(fbl_seen.shift[i], 0, 1, 0);
    }
  }
  return status ? status : fb_body_init(body, &body_work, &shape, &d);
}

/* Models are made anew only where the view or the scene is another one: most of the time would go there. */
typedef struct scene_key {
  double signature;
  int level[FBL_FEATURES];
  fbl_view view;
} scene_key;

static fb_status models_make(const int *level)
{
  static scene_key last;
  scene_key key;
  fb_status status = FB_OK;
  memset(&key, 0, sizeof key);
  fbl_number = 0;
  fbl_stream("signature");
  key.signature = fbl_in(1.0, 2.0);
  memcpy(key.level, level, sizeof key.level);
  key.view = fbl_seen;
  key.view.reverse = key.view.undeformed = 0;
  memset(key.view.boost, 0, sizeof key.view.boost);
  if (memcmp(&key, &last, sizeof key) == 0) {
    return FB_OK;
  }
  memset(&last, 0, sizeof last);
  for (int k = 0; k < MODELS && k < bodies_of(level) && status == FB_OK; k++) {
    const int reverse = fbl_seen.reverse;
    fbl_choice c;
    choose(&c, level, k);
    fbl_number = 1 + k;
    fbl_seen.reverse = 0; /* the order of bodies, not of their parts */
    if (is_solid(level, k)) {
      fbl_stream("solid");
      status = solid_make(&made[k], level, 0, &size_made[k]);
    } else {
      status = fbl_make(&made[k], &c, &size_made[k]);
    }
    fbl_seen.reverse = reverse;
  }
  if (status == FB_OK && level[WHEEL]) {
    status = solid_make(&made[MODELS], level, 1, &size_made[MODELS]);
  }
  fbl_number = 0;
  if (status == FB_OK) {
    last = key;
  }
  return status;
}

static int model_of(int k)
{
  return now[WHEEL] && k == n_body - 1 ? MODELS : k % MODELS;
}

static const fb_body *body(int k)
{
  return &made[model_of(k)];
}

/* ---- tree */

/* Numbers of the bodies in the system: reversed, as far as parents come first. */
static void slots_fill(void)
{
  int placed[BODIES_MOST] = {0};
  for (int s = 0; s < n_body; s++) {
    int next = -1;
    for (int k = 0; k < n_body; k++) {
      const int ready = !placed[k] && (k == 0 || kind[k] == FB_JOINT_FREE || placed[parent[k]]);
      next = ready && (next < 0 || fbl_seen.reverse) ? k : next;
    }
    placed[next] = 1;
    slot[next] = s;
    body_of[s] = next;
  }
  n_model = 0;
  for (int m = 0; m <= MODELS; m++) {
    const int from = fbl_seen.reverse ? MODELS - m : m;
    int used = 0;
    for (int k = 0; k < n_body; k++) {
      used |= model_of(k) == from;
    }
    if (used) {
      model_slot[from] = n_model;
      model[n_model++] = made[from];
    }
  }
}

static void attitude_draw(fb_real q[4], double most, int turned)
{
  double p[4], norm = 1.0;
  p[0] = 1.0;
  for (int i = 1; i < 4; i++) {
    p[i] = fbl_in(-most, most);
    norm += p[i] * p[i];
  }
  for (int i = 0; i < 4; i++) {
    p[i] /= sqrt(norm);
  }
  fbl_quat(q, p, turned);
}

/* A place on the ground, or on a body (relative to a node). */
static void place_draw(fb_real r[3], double most, int ground)
{
  double x[3];
  for (int i = 0; i < 3; i++) {
    x[i] = fbl_in(-most, most);
  }
  if (ground) {
    fbl_inertial_polar(r, x[0], x[1], x[2], 0, 1, 0);
    for (int i = 0; i < 3; i++) {
      r[i] += fbl_unit(fbl_seen.shift[i], 0, 1, 0);
    }
  } else {
    fbl_polar(r, x[0], x[1], x[2], 0, 1, 0);
  }
}

static void effort_draw(fb_joint_desc *d)
{
  for (int i = 0; i < axes_of(d->kind) && i < 3; i++) {
    const int ball = is_ball(d->kind), scalar = ball && i > 0;
    const double k = fbl_in(5.0, 20.0), rest = fbl_in(-0.3, 0.3), c = fbl_in(0.2, 1.0), rub = fbl_in(0.5, 2.0);
    const double low = fbl_in(-0.3, 0.0), high = low + fbl_in(0.1, 0.4), hard = fbl_in(20.0, 60.0);
    if (scalar || d->kind == FB_JOINT_FREE) {
      continue;
    }
    if (now[EFFORT] == SPRUNG || (ball && now[EFFORT] > MOTOR)) {
      d->stiffness[i] = fbl_unit(k, 1, slides(d->kind, i) ? 0 : 2, -2);
      d->rest[i] = ball ? FB_R(0.0) : seen_axis(d->kind, i, rest, 0, 0);
      d->damping[i] = fbl_unit(c, 1, slides(d->kind, i) ? 0 : 2, -1);
    } else if (now[EFFORT] == FRICTION) {
      d->friction[i] = fbl_unit(rub, 1, slides(d->kind, i) ? 1 : 2, -2);
      d->friction_speed[i] = fbl_unit(0.5, 0, slides(d->kind, i), -1);
    } else if (now[EFFORT] == STOP) {
      const fb_real a = seen_axis(d->kind, i, low, 0, 0), b = seen_axis(d->kind, i, high, 0, 0);
      d->stop[i][0] = a < b ? a : b;
      d->stop[i][1] = a < b ? b : a;
      d->stop_stiffness[i] = fbl_unit(hard, 1, slides(d->kind, i) ? 0 : 2, -2);
      d->stop_loss[i] = fbl_unit(0.2, 0, slides(d->kind, i) ? -1 : 0, 1);
    }
  }
}

static void frames_draw(fb_joint_desc *d, int ground)
{
  const double most = 0.3;
  place_draw(d->child_position, most, 0);
  if (now[FRAME] != PLAIN || ground) {
    place_draw(d->position, most, ground);
  }
  if (now[FRAME] == BY_AXIS && !ground) {
    fbl_polar(d->axis, fbl_in(-1.0, 1.0), fbl_in(-1.0, 1.0), fbl_in(0.1, 1.0), 0, 0, 0);
    fbl_polar(d->child_axis, fbl_in(-1.0, 1.0), fbl_in(-1.0, 1.0), fbl_in(0.1, 1.0), 0, 0, 0);
  } else if (ground && now[LOOP] == PLANAR) {
    const double level_[4] = {1.0, 0.0, 0.0, 0.0};
    fbl_quat(d->attitude, level_, 1);
  } else if (now[FRAME] == TURNED || ground) {
    attitude_draw(d->attitude, 0.8, ground);
    attitude_draw(d->child_attitude, 0.8, 0);
  }
}

static void joint_draw(int k)
{
  fb_joint_desc *const d = &desc.joint[slot[k]];
  const int wheel = now[WHEEL] && k == n_body - 1, ground = k == 0;
  fbl_number = 1 + k;
  fbl_stream("joint");
  d->kind = kind[k];
  d->parent = ground ? FB_GROUND : slot[parent[k]];
  if (k == 0 && d->kind == FB_JOINT_FREE) {
    d->mode[0] = mode_of(now, 0, 0);
    return;
  }
  if (d->kind == FB_JOINT_FREE) {
    d->parent = FB_GROUND;
    return;
  }
  d->parent_node = !ground && !wheel && now[AT] == ON_TIP ? 1 : 0;
  frames_draw(d, ground);
  for (int i = 0; i < 3 && !wheel; i++) {
    d->mode[i] = d->kind == FB_JOINT_SPHERICAL && i > 0 ? FB_AXIS_FREE : mode_of(now, k, i);
  }
  if (d->kind == FB_JOINT_SCREW) {
    d->pitch = fbl_unit(fbl_seen.mirror ? -0.2 : 0.2, 0, 1, 0);
  }
  fbl_stream("effort");
  if (wheel) {
    memset(d->child_position, 0, sizeof d->child_position);
    memset(d->child_attitude, 0, sizeof d->child_attitude);
    memset(d->child_axis, 0, sizeof d->child_axis);
    if (now[FRAME] == BY_AXIS) {
      d->child_axis[2] = FB_R(1.0);
    }
  } else {
    effort_draw(d);
  }
}

static void springs_draw(void)
{
  const int two = now[SPRING] == PULL || now[SPRING] == BETWEEN, n = n_body - (now[WHEEL] != 0);
  desc.n_spring = now[SPRING] == NO_SPRING ? 0 : now[SPRING] == PULL ? 2 : 1;
  fbl_number = 0;
  fbl_stream("springs");
  for (int j = 0; j < desc.n_spring; j++) {
    fb_spring *const s = &desc.spring[fbl_seen.reverse ? desc.n_spring - 1 - j : j];
    const int ground = !two || j == 1 || n == 1;
    s->body[0] = ground ? FB_GROUND : slot[0];
    s->body[1] = slot[n - 1];
    s->node[1] = j == 0 ? 1 : 0;
    place_draw(s->position[0], 2.0, ground);
    place_draw(s->position[1], 0.5, 0);
    s->stiffness = fbl_unit(fbl_in(2.0, 8.0), 1, 0, -2);
    s->length = fbl_unit(fbl_in(0.2, 1.0), 0, 1, 0);
    s->damping = fbl_unit(fbl_in(0.1, 1.0), 1, 0, -1);
  }
}

/* ---- inputs at the drawn time t */

typedef struct wave {
  double x, rate, acceleration;
} wave;

static wave wave_at(double t, double size_of)
{
  const double w = fbl_in(0.5, 2.0), phase = fbl_in(-1.5, 1.5), a = size_of * fbl_in(0.5, 1.0);
  wave out;
  out.x = a * sin(w * t + phase);
  out.rate = a * w * cos(w * t + phase);
  out.acceleration = -a * w * w * sin(w * t + phase);
  return out;
}

static fb_status wind(fb_line_point *point, int n, fb_real t, void *user)
{
  fb_real along[3];
  (void)t, (void)user;
  fbl_inertial_polar(along, 0.1, -0.15, 0.2, 1, 0, -2);
  for (int k = 0; k < n; k++) {
    const double share = (double)point[k].length * (1.0 + (double)point[k].x / (double)fbl_unit(size, 0, 1, 0));
    for (int i = 0; i < 3; i++) {
      point[k].force[i] = (fb_real)(share * (double)along[i]);
    }
  }
  return FB_OK;
}

/* Drag at the loads, motors that brake, actuators that damp. */
static fb_status forces(fb_system_forces *f, void *user)
{
  const double drag = (double)fbl_unit(0.2, 1, 0, -1);
  (void)user;
  for (int k = 0; k < f->n_point; k++) {
    for (int i = 0; i < 3; i++) {
      f->point[k].force[i] = (fb_real)(-drag * (double)f->point[k].velocity[i]);
      f->point[k].torque[i] = -fbl_unit(0.1, 1, 2, -1) * f->point[k].angular_rate[i];
    }
  }
  for (int j = 0; j < f->n_joint; j++) {
    const fb_joint_kind k = mechanism.joint[j].kind;
    for (int i = 0; i < axes_of(k) && i < 3 && k != FB_JOINT_FREE; i++) {
      f->joint[j].torque[i] = -fbl_unit(0.3, 1, slides(k, i) ? 0 : 2, -1) * f->joint[j].speed[i];
    }
  }
  for (int j = 0; j < f->n_spring; j++) {
    f->pull[j] = -fbl_unit(0.2, 1, 0, -1) * f->spring[j].rate;
  }
  return FB_OK;
}

static int rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  fb_real off[3];
  (void)t, (void)user;
  if (capacity < 1) {
    return FB_ERR_CAPACITY;
  }
  *row = held;
  for (int i = 0; i < 3; i++) {
    off[i] = pose[held.body[0]].position[i] - held.force[1][i]; /* the place, in what the other side does not use */
    row->force[1][i] = FB_R(0.0);
  }
  row->value = fb_vec3_dot(held.force[0], off);
  return 1;
}

static void drive_fill(fb_drive *d, fb_joint_kind k, const fb_axis_mode *mode, double t)
{
  const int ball = is_ball(k);
  for (int i = 0; i < axes_of(k); i++) {
    const fb_axis_mode own = mode[ball ? 0 : i];
    const wave w = wave_at(t, 0.3), torque = wave_at(t, 2.0);
    if (own == FB_AXIS_PRESCRIBED && k == FB_JOINT_FREE) {
      const double sign = fbl_seen.mirror && (i == 1 || i == 3 || i == 5) ? -1.0 : 1.0;
      d->rate[i] = fbl_unit(sign * w.rate, 0, i < 3, -1);
      d->acceleration[i] = fbl_unit(sign * w.acceleration, 0, i < 3, -2);
    } else if (own == FB_AXIS_PRESCRIBED) {
      d->value[i] = ball ? FB_R(0.0) : seen_axis(k, i, w.x, 0, 0);
      d->rate[i] = seen_axis(k, i, w.rate, 0, -1);
      d->acceleration[i] = seen_axis(k, i, w.acceleration, 0, -2);
    } else if (own == FB_AXIS_FREE && k != FB_JOINT_FREE && now[EFFORT] == MOTOR) {
      d->torque[i] = seen_axis(k, i, torque.x, 1, -2);
    }
  }
}

static void load_fill(fb_system_load *load, int k, int node, double t)
{
  const double all = 1.0 + wave_at(t, 0.5).x, force = all * (now[LOAD] == NO_LOAD ? 0.0 : 3.0), torque = 0.3 * force;
  double f[3], m[3];
  load->body = slot[k];
  load->load.node = node;
  load->load.axes = now[LOAD] == FOLLOWER ? FB_AXES_NODE : now[LOAD] == BODY_LOAD ? FB_AXES_BODY : FB_AXES_INERTIAL;
  for (int i = 0; i < 3; i++) {
    f[i] = force * fbl_in(-1.0, 1.0);
    m[i] = torque * fbl_in(-1.0, 1.0);
  }
  if (load->load.axes == FB_AXES_INERTIAL) {
    fbl_inertial_polar(load->load.force, f[0], f[1], f[2], 1, 1, -2);
    fbl_inertial_axial(load->load.torque, m[0], m[1], m[2], 1, 2, -2);
  } else {
    fbl_polar(load->load.force, f[0], f[1], f[2], 1, 1, -2);
    fbl_axial(load->load.torque, m[0], m[1], m[2], 1, 2, -2);
  }
}

static void input_fill(fb_system_input *in, double t)
{
  memset(in, 0, sizeof *in);
  in->t = fbl_unit(t, 0, 0, 1);
  for (int j = 0; j < n_body + desc.n_loop; j++) {
    fbl_number = 1 + (j < n_body ? j : BODIES_MOST + j - n_body);
    fbl_stream("drive");
    if (j < n_body) {
      drive_fill(&in->drive[slot[j]], kind[j], desc.joint[slot[j]].mode, t);
    } else {
      const int l = fbl_seen.reverse ? desc.n_loop - 1 - (j - n_body) : j - n_body;
      drive_fill(&in->drive[n_body + l], desc.loop[l].kind, desc.loop[l].mode, t);
    }
  }
  fbl_number = 0;
  if ((now[LOAD] != NO_LOAD && now[LOAD] != DISTRIBUTED) || now[CALLBACK] == FORCES) {
    in->n_load = 2;
    for (int k = 0; k < 2; k++) {
      fbl_number = k;
      fbl_stream("load");
      load_fill(&in->load[fbl_seen.reverse ? 1 - k : k], k == 0 ? bodies_of(now) - 1 : 0, k == 0 ? 1 : 0, t);
    }
  }
  fbl_number = 0;
  fbl_stream("pull");
  for (int j = 0; j < desc.n_spring && now[SPRING] == PULL; j++) {
    in->pull[fbl_seen.reverse ? desc.n_spring - 1 - j : j] = fbl_unit(wave_at(t, 2.0).x, 1, 1, -2);
  }
  fbl_stream("rotors");
  for (int r = 0; r < body(0)->n_rotor; r++) {
    const wave w = wave_at(t, 0.1), h = wave_at(t, 1.0);
    fb_rotor_input *const rotor = &in->rotor[slot[0]][r];
    rotor->torque = fbl_unit(body(0)->rotor[r].given ? h.rate : w.x, 1, 2, -2);
    rotor->momentum = body(0)->rotor[r].given ? fbl_unit(h.x, 1, 2, -1) : FB_R(0.0);
  }
  for (int k = 3; k < bodies_of(now); k++) { /* the same model, wheels of its own */
    memcpy(in->rotor[slot[k]], in->rotor[slot[0]], (k % MODELS == 0) * sizeof in->rotor[0]);
  }
  in->distributed = now[LOAD] == DISTRIBUTED ? wind : NULL;
  in->forces = now[CALLBACK] == FORCES ? forces : NULL;
  in->rows = now[CALLBACK] == ROWS ? rows : NULL;
}

/* ---- state */

static void start_draw(int k)
{
  fb_link_motion *const m = &start[slot[k]];
  const int wheel = now[WHEEL] && k == n_body - 1;
  const double fast = now[MOTION] == SLOW ? 0.2 : 1.5, speed = now[MOTION] == FLIGHT ? 400.0 : 0.3;
  fbl_number = 1 + k;
  memset(m, 0, sizeof *m);
  fbl_deflect(m->q, m->q_dot, body(k), size_made[model_of(k)]);
  fbl_stream("start");
  if (kind[k] == FB_JOINT_FREE) {
    fb_real u[3], R[9];
    attitude_draw(m->quat, 0.8, 1);
    place_draw(m->value, k ? 4.0 : 0.5, 1);
    fbl_number = 1; /* the velocity of flight is that of all */
    fbl_stream("flight");
    fbl_inertial_polar(u, fbl_in(-speed, speed), fbl_in(-speed, speed), fbl_in(-speed, speed), 0, 1, -1);
    fbl_number = 1 + k;
    fbl_stream("spin");
    for (int i = 0; i < 3; i++) {
      fb_real b[3];
      fbl_inertial_polar(b, fbl_seen.boost[0], fbl_seen.boost[1], fbl_seen.boost[2], 0, 1, -1);
      u[i] += b[i];
    }
    fb_quat_to_mat33(R, m->quat);
    for (int i = 0; i < 3; i++) {
      m->speed[i] = R[i] * u[0] + R[3 + i] * u[1] + R[6 + i] * u[2];
    }
    fbl_axial(&m->speed[3], fbl_in(-fast, fast), fbl_in(-fast, fast), fbl_in(-fast, fast), 0, 0, -1);
  } else if (kind[k] == FB_JOINT_SPHERICAL) {
    attitude_draw(m->quat, 0.2, 0);
    fbl_axial(m->speed, fbl_in(-fast, fast), fbl_in(-fast, fast), fbl_in(-fast, fast), 0, 0, -1);
  } else {
    for (int i = 0; i < axes_of(kind[k]); i++) {
      m->value[i] = seen_axis(kind[k], i, fbl_in(-0.5, 0.5), 0, 0);
      m->speed[i] = seen_axis(kind[k], i, wheel ? fbl_in(10.0, 40.0) : fbl_in(-fast, fast), 0, -1);
    }
  }
  fbl_stream("wheels");
  for (int r = 0; r < body(k)->n_rotor; r++) {
    m->rotor_speed[r] = fbl_unit(fbl_in(-60.0, 60.0), 0, 0, -1);
    m->rotor_angle[r] = (fb_real)fbl_in(-1.0, 1.0);
  }
}

typedef struct look {
  fb_system_state state;
  fb_system_motion motion;
  fb_node_motion node[BODIES_MOST][FB_MAX_NODES]; /* by bodies of the scene */
  fb_momentum body[BODIES_MOST];
  fb_energy energy;
  fb_momentum momentum;
} look;

static fb_status nodes_look(look *at)
{
  fb_status status = FB_OK;
  for (int k = 0; k < n_body; k++) {
    const int s = slot[k];
    for (int i = 0; i < body(k)->n_node && status == FB_OK; i++) {
      status = fb_body_node_motion_eval(body(k), &at->node[k][i], &at->motion.pose[s], &at->motion.motion[s], i);
    }
  }
  return status;
}

/* Loops that are closed where the motion starts: the frame on one side follows from that on the other. */
static void loop_draw(int l, const look *at)
{
  fb_joint_desc *const d = &desc.loop[fbl_seen.reverse ? desc.n_loop - 1 - l : l];
  fb_real q[4], R[9], origin[3];
  int from, to;
  const fb_node_motion *child;
  loop_ends(now, l, &from, &to);
  fbl_number = 1 + BODIES_MOST + l;
  fbl_stream("loop");
  memset(d, 0, sizeof *d);
  d->kind = loop_kind(now, l);
  d->parent = from < 0 ? FB_GROUND : slot[from];
  d->child = slot[to];
  d->parent_node = from < 0 ? 0 : 1;
  d->child_node = 1;
  place_draw(d->position, 1.0, from < 0);
  attitude_draw(d->attitude, 0.8, from < 0);
  if (now[LOOP] == PLANAR) { /* as the first joint */
    memcpy(d->attitude, desc.joint[0].attitude, sizeof d->attitude);
  }
  child = &at->node[to][1];
  if (from < 0) {
    memcpy(origin, d->position, sizeof origin);
    memcpy(q, d->attitude, sizeof q);
  } else {
    fb_quat_to_mat33(R, at->node[from][1].quat);
    fb_mat33_mul_vec3(origin, R, d->position);
    fb_quat_mul(q, at->node[from][1].quat, d->attitude);
    for (int i = 0; i < 3; i++) {
      origin[i] += at->node[from][1].position[i];
    }
  }
  fb_quat_to_mat33(R, child->quat);
  for (int i = 0; i < 3; i++) {
    origin[i] -= child->position[i];
  }
  for (int i = 0; i < 3; i++) {
    d->child_position[i] = R[i] * origin[0] + R[3 + i] * origin[1] + R[6 + i] * origin[2];
  }
  {
    const fb_real back[4] = {child->quat[0], -child->quat[1], -child->quat[2], -child->quat[3]};
    fb_quat_mul(d->child_attitude, back, q);
  }
  fbl_stream("effort of a loop");
  if (now[LOOP] != PLANAR) {
    effort_draw(d);
  }
}

static fb_status state_draw(fb_system_input *in)
{
  return fb_system_state_init(&mechanism, model, &state, &work, start, in);
}

static fb_status system_make(void)
{
  static fb_system_work init_work;
  return fb_system_init(&mechanism, &init_work, model, &desc, n_model);
}

/* The plane in which the origin of the last body stays. */
static void held_draw(const look *at)
{
  const int k = bodies_of(now) - 1;
  memset(&held, 0, sizeof held);
  held.body[0] = slot[k];
  held.body[1] = FB_GROUND;
  held.holonomic = 1;
  fbl_inertial_polar(held.force[0], 0.48, -0.6, 0.64, 0, 0, 0);
  memcpy(held.force[1], at->motion.pose[slot[k]].rho, sizeof held.force[1]);
}

static fb_status draw_(const int *level);
static fb_status draw(const int *level)
{
  fb_status st = draw_(level);
  if (st && getenv("DBG")) { printf("DRAW %d %s: ", st, fb_detail_last()->what); for (int i = 0; i < N_FEATURE; i++) printf("%d,", level[i]); printf("\n"); }
  return st;
}
static fb_status draw_(const int *level)
{
  static fb_system_input in;
  static look open;
  fb_status status;
  memcpy(now, level, sizeof now);
  status = models_make(level);
  if (status != FB_OK) {
    return status;
  }
  n_body = bodies_of(level) + (level[WHEEL] != 0);
  size = 0.0;
  for (int k = 0; k < n_body; k++) {
    const int wheel = level[WHEEL] && k == n_body - 1;
    parent[k] = k == 0 ? FB_GROUND : wheel ? 0 : parent_of(level, k);
    kind[k] = wheel ? FB_JOINT_REVOLUTE : kind_of(level, k);
    size = size_made[model_of(k)] > size ? size_made[model_of(k)] : size;
  }
  slots_fill();
  memset(&desc, 0, sizeof desc);
  desc.n_body = n_body;
  desc.method = (fb_method)level[METHOD];
  for (int k = 0; k < n_body; k++) {
    desc.model[slot[k]] = model_slot[model_of(k)];
    joint_draw(k);
    start_draw(k);
  }
  springs_draw();
  input_fill(&in, 0.0);
  if (loops_of(level) > 0 || level[CALLBACK] == ROWS) {
    const fb_rows own = in.rows;
    desc.method = FB_METHOD_RECURSIVE;
    status = system_make();
    in.rows = NULL;
    in.forces = NULL;
    status = status ? status : state_draw(&in);
    status = status ? status : fb_system_motion_eval(&mechanism, model, &work, &open.motion, &state, &in);
    status = status ? status : nodes_look(&open);
    if (status != FB_OK) {
      return status;
    }
    in.rows = own;
    desc.n_loop = loops_of(level);
    for (int l = 0; l < desc.n_loop; l++) {
      loop_draw(l, &open);
    }
    held_draw(&open);
    desc.method = (fb_method)level[METHOD];
    input_fill(&in, 0.0);
  }
  fbl_number = 0;
  status = system_make();
  return status ? status : state_draw(&in);
}

/* ---- five states that follow each other, and all that can be asked of them */

static look path[5];
static fb_system_input input; /* at path[2] */
static double dt;

static double larger(double a, double b)
{
  return a > b ? a : b;
}

/* State of body k alone, at a look. */
static fb_status alone(fb_state *out, fb_input *in, const look *at, const fb_system_input *all, int k)
{
  const int s = slot[k];
  const fb_motion *const m = &at->motion.motion[s];
  fb_status status = fb_state_init(body(k), out);
  memset(in, 0, sizeof *in);
  memcpy(in->rotor, all->rotor[s], sizeof in->rotor);
  memcpy(out->rho, at->motion.pose[s].rho, sizeof out->rho);
  memcpy(out->quat, at->motion.pose[s].quat, sizeof out->quat);
  memcpy(out->q, at->motion.pose[s].q, (size_t)body(k)->n * sizeof out->q[0]);
  status = status ? status : fb_state_from_velocity(body(k), out, m->v, m->w, m->q_dot);
  for (int r = 0; r < body(k)->n_rotor && status == FB_OK; r++) {
    if (!body(k)->rotor[r].given) {
      status = fb_state_rotor_set(body(k), out, r, m->rotor_speed[r], FB_R(0.0), in);
    }
  }
  return status;
}

static fb_status look_at(look *at, const fb_system_state *where, const fb_system_input *in)
{
  fb_status status = fb_system_motion_eval(&mechanism, model, &work, &at->motion, where, in);
  at->state = *where;
  status = status ? status : nodes_look(at);
  status = status ? status : fb_system_energy_eval(&mechanism, model, &work, &at->energy, where, in);
  status = status ? status : fb_system_momentum_eval(&mechanism, model, &work, &at->momentum, where, in);
  for (int k = 0; k < n_body && status == FB_OK; k++) {
    static fb_state own;
    static fb_input own_input;
    status = alone(&own, &own_input, at, in, k);
    status = status ? status : fb_body_momentum_eval(body(k), &at->body[k], &own, &own_input);
  }
  return status;
}

static double step_of(fb_status *status)
{
  static fb_system_input in;
  fb_system_limit limit;
  const double most = (double)fbl_unit(0.1, 0, 0, 1);
  input_fill(&in, 0.0);
  *status = fb_system_limit_eval(&mechanism, model, &work, &limit, &state, &in);
  return *status == FB_OK && (double)limit.rk4 < most ? (double)limit.rk4 : most;
}

/* One step of rk4 from the time t, both in units of the model. */
static fb_status rk4(fb_system_state *at, double t, double step)
{
  static fb_system_input in[3];
  const double unit = (double)fbl_unit(1.0, 0, 0, 1);
  for (int k = 0; k < 3; k++) {
    input_fill(&in[k], (t + 0.5 * k * step) / unit);
  }
  return fb_system_rk4_step(&mechanism, model, at, &work, &in[0], &in[1], &in[2], (fb_real)step);
}

/* h: in units of the longest step */
static fb_status walk(double h)
{
  static fb_system_state at;
  static fb_system_input in;
  fb_status status;
  dt = h * step_of(&status);
  at = state;
  for (int k = 0; k < 5 && status == FB_OK; k++) {
    input_fill(&in, k * dt / (double)fbl_unit(1.0, 0, 0, 1));
    if (k == 2) {
      input = in;
    }
    status = look_at(&path[k], &at, &in);
    status = status || k == 4 ? status : rk4(&at, k * dt, dt);
  }
  return status;
}

#define SLOPE(member) fbl_slope(&path[0].member, sizeof(look) / sizeof(fb_real), dt)
typedef char looks_are_whole[sizeof(look) % sizeof(fb_real) == 0 ? 1 : -1];

/* Rate of rotation by differences of quaternions, inertial axes: 2 q_dot conj(q). */
static void rotation_rate(double w[3], int k, int node)
{
  double d[4], q[4];
  fb_real along[5];
  for (int i = 0; i < 4; i++) {
    for (int p = 0; p < 5; p++) {
      double cosine = 0.0;
      for (int j = 0; j < 4; j++) {
        cosine += (double)path[p].node[k][node].quat[j] * (double)path[2].node[k][node].quat[j];
      }
      along[p] = (fb_real)((cosine < 0.0 ? -1.0 : 1.0) * (double)path[p].node[k][node].quat[i]);
    }
    d[i] = fbl_slope(along, 1, dt);
    q[i] = (double)path[2].node[k][node].quat[i];
  }
  w[0] = 2.0 * (d[1] * q[0] - d[0] * q[1] - d[2] * q[3] + d[3] * q[2]);
  w[1] = 2.0 * (d[2] * q[0] - d[0] * q[2] - d[3] * q[1] + d[1] * q[3]);
  w[2] = 2.0 * (d[3] * q[0] - d[0] * q[3] - d[1] * q[2] + d[2] * q[1]);
}

/* ---- laws: derivatives */

static double velocities(double h)
{
  double miss = 0.0;
  FBL_TRY(walk(h));
  for (int k = 0; k < n_body; k++) {
    for (int n = 0; n < body(k)->n_node; n++) {
      const fb_node_motion *const at = &path[2].node[k][n];
      double w[3], v_off = 0.0, w_off = 0.0;
      rotation_rate(w, k, n);
      for (int i = 0; i < 3; i++) {
        v_off = larger(v_off, fabs(SLOPE(node[k][n].position[i]) - (double)at->velocity[i]));
        w_off = larger(w_off, fabs(w[i] - (double)at->angular_rate[i]));
      }
      miss = larger(miss, v_off / (fbl_largest(at->velocity, 3) + 0.1 * (double)fbl_unit(size, 0, 1, -1)));
      miss = larger(miss, w_off / (fbl_largest(at->angular_rate, 3) + 0.1 * (double)fbl_unit(1.0, 0, 0, -1)));
    }
  }
  return miss;
}

static double accelerations(double h)
{
  double miss = 0.0;
  FBL_TRY(walk(h));
  for (int k = 0; k < n_body; k++) {
    for (int n = 0; n < body(k)->n_node; n++) {
      const fb_node_motion *const at = &path[2].node[k][n];
      double a_off = 0.0, w_off = 0.0;
      for (int i = 0; i < 3; i++) {
        a_off = larger(a_off, fabs(SLOPE(node[k][n].velocity[i]) - (double)at->acceleration[i]));
        w_off = larger(w_off, fabs(SLOPE(node[k][n].angular_rate[i]) - (double)at->angular_acceleration[i]));
      }
      miss = larger(miss, a_off / (fbl_largest(at->acceleration, 3) + (double)fbl_unit(size, 0, 1, -2)));
      miss = larger(miss, w_off / (fbl_largest(at->angular_acceleration, 3) + (double)fbl_unit(1.0, 0, 0, -2)));
    }
  }
  return miss;
}

/* What an IMU reads is the rate of the node's velocity less gravity, in the axes of its section. */
static double imus(double h)
{
  double miss = 0.0;
  FBL_TRY(walk(h));
  for (int k = 0; k < n_body; k++) {
    const int n = body(k)->n_node - 1;
    const fb_node_motion *const at = &path[2].node[k][n];
    fb_real g[3], R[9], a[3], w[3], off[2][3];
    fb_imu imu;
    FBL_TRY(fb_body_gravity_eval(body(k), g, at->position));
    fb_imu_eval(&imu, at, g);
    fb_quat_to_mat33(R, at->quat);
    for (int i = 0; i < 3; i++) {
      a[i] = (fb_real)SLOPE(node[k][n].velocity[i]) - g[i];
    }
    memcpy(w, at->angular_rate, sizeof w);
    for (int i = 0; i < 3; i++) {
      off[0][i] = R[i] * a[0] + R[3 + i] * a[1] + R[6 + i] * a[2];
      off[1][i] = R[i] * w[0] + R[3 + i] * w[1] + R[6 + i] * w[2];
    }
    miss = larger(miss, fbl_difference(off[0], imu.specific_force, 3) / (fbl_largest(a, 3) + (double)fbl_unit(size, 0, 1, -2)));
    miss = larger(miss, fbl_difference(off[1], imu.angular_rate, 3) / (fbl_largest(w, 3) + (double)fbl_unit(1.0, 0, 0, -1)));
  }
  return miss;
}

static double coordinates(double h)
{
  double miss = 0.0;
  FBL_TRY(walk(h));
  for (int k = 0; k < n_body; k++) {
    const int s = slot[k], n = body(k)->n;
    const fb_motion *const m = &path[2].motion.motion[s];
    double off[3] = {0.0, 0.0, 0.0};
    for (int a = 0; a < n; a++) {
      off[0] = larger(off[0], fabs(SLOPE(motion.pose[s].q[a]) - (double)m->q_dot[a]));
      off[1] = larger(off[1], fabs(SLOPE(motion.motion[s].q_dot[a]) - (double)m->q_ddot[a]));
    }
    for (int i = 0; i < 3; i++) {
      off[2] = larger(off[2], fabs(SLOPE(motion.motion[s].w[i]) - (double)m->w_dot[i]));
    }
    miss = larger(miss, n ? off[0] / larger(1e-300, fbl_largest(m->q_dot, n)) : 0.0);
    miss = larger(miss, n ? off[1] / larger(1e-300, fbl_largest(m->q_ddot, n)) : 0.0);
    miss = larger(miss, off[2] / (fbl_largest(m->w_dot, 3) + (double)fbl_unit(1.0, 0, 0, -2)));
  }
  return miss;
}

static double joints(double h)
{
  double miss = 0.0;
  FBL_TRY(walk(h));
  for (int j = 0; j < n_body + desc.n_loop; j++) {
    const fb_joint *const joint = &mechanism.joint[j];
    const fb_joint_motion *const at = &path[2].motion.joint[j];
    const int kept = j >= n_body || mechanism.method == FB_METHOD_MULTIPLIERS;
    for (int i = 0; i < axes_of(joint->kind) && joint->kind != FB_JOINT_FREE; i++) {
      const double second = (double)fbl_unit(1.0, 0, slides(joint->kind, i), -1);
      const int jumps = fabs((double)path[4].motion.joint[j].value[i] - (double)path[0].motion.joint[j].value[i]) > 1.0;
      if (!is_ball(joint->kind) && !jumps) {
        miss = larger(miss, fabs(SLOPE(motion.joint[j].value[i]) - (double)at->speed[i]) / (fabs((double)at->speed[i]) + second));
      }
      if (!kept) {
        const double unit = (double)fbl_unit(1.0, 0, slides(joint->kind, i), -2);
        miss = larger(miss, fabs(SLOPE(motion.joint[j].speed[i]) - (double)at->acceleration[i]) /
                                (fabs((double)at->acceleration[i]) + unit));
      }
    }
  }
  return miss;
}

/* ---- laws: balances */

static double dot(const fb_real *a, const fb_real *b)
{
  return (double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] + (double)a[2] * (double)b[2];
}

static void to_inertial(fb_real *out, const fb_real quat[4], const fb_real *x)
{
  fb_real R[9];
  fb_quat_to_mat33(R, quat);
  fb_mat33_mul_vec3(out, R, x);
}

/* Load k of the input and of the callback at path[2], inertial axes, at its node. */
static const fb_node_motion *load_now(fb_real force[3], fb_real torque[3], int k)
{
  const fb_load *const load = &input.load[k].load;
  const int s = input.load[k].body;
  const fb_node_motion *const node = &path[2].node[body_of[s]][load->node];
  const fb_real *const quat = load->axes == FB_AXES_NODE ? node->quat : path[2].motion.pose[s].quat;
  if (load->axes == FB_AXES_INERTIAL) {
    memcpy(force, load->force, 3 * sizeof *force);
    memcpy(torque, load->torque, 3 * sizeof *torque);
  } else {
    to_inertial(force, quat, load->force);
    to_inertial(torque, quat, load->torque);
  }
  for (int i = 0; i < 3; i++) {
    force[i] += path[2].motion.force[k][i];
    torque[i] += path[2].motion.torque[k][i];
  }
  return node;
}

/* Power that the modes of a body lose to their dampers. */
static double damping_power(int k)
{
  const fb_body *const b = body(k);
  const fb_real *const x = path[2].motion.motion[slot[k]].q_dot;
  double sum = 0.0;
  if (!(b->effects & FB_EFFECT_DAMPING)) {
    return 0.0;
  }
  for (int a = 0; a < b->n; a++) {
    sum += (double)b->C.diagonal[a] * (double)x[a] * (double)x[a];
  }
  for (int i = 0; i < b->C.n_term; i++) {
    sum += 2.0 * (double)b->C.term[i].c * (double)x[b->C.term[i].a] * (double)x[b->C.term[i].b];
  }
  return -sum;
}

/* Effort of axis i of joint j without motor: spring, damper, friction, stop (E9.11, E9.28, E9.29); lost: the power of all
   but the springs. */
static double effort(double *lost, int j, int i)
{
  const fb_joint *const d = &mechanism.joint[j];
  const fb_joint_motion *const at = &path[2].motion.joint[j];
  const double x = (double)at->value[i], u = (double)at->speed[i], k = (double)d->stop_stiffness[i];
  const double depth = x < (double)d->stop[i][0] ? x - (double)d->stop[i][0] : x > (double)d->stop[i][1] ? x - (double)d->stop[i][1] : 0.0;
  const double inwards = depth < 0.0 ? -u : u;
  const double spring = -(double)d->stiffness[i] * (x - (double)d->rest[i]) - (k > 0.0 ? k * depth : 0.0);
  double rest = -(double)d->damping[i] * u;
  if (d->friction[i] > FB_R(0.0)) {
    rest -= (double)d->friction[i] * u / sqrt(u * u + (double)d->friction_speed[i] * (double)d->friction_speed[i]);
  }
  if (k > 0.0) {
    rest -= k * depth * (larger(1.0 + (double)d->stop_loss[i] * inwards, 0.0) - 1.0);
  }
  *lost = rest * u;
  return spring + rest;
}

static double joint_losses(void)
{
  double sum = 0.0;
  for (int j = 0; j < n_body + desc.n_loop; j++) {
    const fb_joint *const d = &mechanism.joint[j];
    for (int i = 0; i < axes_of(d->kind) && d->kind != FB_JOINT_FREE; i++) {
      double lost;
      (void)effort(&lost, j, i);
      sum += lost;
    }
  }
  for (int j = 0; j < desc.n_spring; j++) {
    const double rate = (double)path[2].motion.spring[j].rate;
    sum -= (double)mechanism.spring[j].damping * rate * rate;
  }
  return sum;
}

/* Friction of rotors; motion.power has their motors. */
static double rotor_losses(void)
{
  double sum = 0.0;
  for (int k = 0; k < n_body; k++) {
    for (int r = 0; r < body(k)->n_rotor; r++) {
      const fb_rotor *const rotor = &body(k)->rotor[r];
      const double u = (double)path[2].motion.motion[slot[k]].rotor_speed[r];
      sum -= (double)rotor->damping * u * u;
      if (rotor->friction > FB_R(0.0)) {
        sum -= (double)rotor->friction * u * u / sqrt(u * u + (double)rotor->friction_speed * (double)rotor->friction_speed);
      }
    }
  }
  return sum;
}

static double energy_rate(double h)
{
  double rate, power, size_of;
  if (now[ROTORS] == FBL_UNBALANCED || now[ROTORS] == FBL_GIVEN || now[LOAD] == DISTRIBUTED) {
    return FBL_NONE;
  }
  FBL_TRY(walk(h));
  rate = SLOPE(energy.kinetic) + SLOPE(energy.strain) + SLOPE(energy.gravity);
  size_of = fabs(SLOPE(energy.kinetic)) + fabs(SLOPE(energy.strain)) + fabs(SLOPE(energy.gravity));
  power = joint_losses() + (double)path[2].motion.power + rotor_losses();
  size_of += fabs(joint_losses()) + fabs((double)path[2].motion.power) + fabs(rotor_losses());
  for (int k = 0; k < n_body; k++) {
    power += damping_power(k);
  }
  for (int k = 0; k < input.n_load; k++) {
    fb_real force[3], torque[3];
    const fb_node_motion *const node = load_now(force, torque, k);
    power += dot(force, node->velocity) + dot(torque, node->angular_rate);
    size_of += fabs(dot(force, node->velocity)) + fabs(dot(torque, node->angular_rate));
  }
  return fabs(rate - power) / (size_of + (double)path[2].energy.kinetic * (double)fbl_unit(1.0, 0, 0, -1) + (double)fbl_unit(1e-3, 1, 2, -3));
}

/* ---- the list */

static const fbl_law laws[] = {
    {"velocities_are_derivatives", "E9.1 E9.5", velocities, 0.02, {1e-7, 3e-2}},
    {"accelerations_are_derivatives", "E9.18 E9.19", accelerations, 0.02, {1e-6, 0}},
    {"imus_read_derivatives", "E8.20 E9.19", imus, 0.02, {1e-6, 0}},
    {"coordinates_and_their_rates", "E9.5 E9.19", coordinates, 0.02, {1e-6, 0}},
    {"joints_and_their_rates", "E9.5 E9.19", joints, 0.02, {1e-6, 0}},
    {"energy_changes_by_power", "E9.11 E9.14 E9.15", energy_rate, 0.02, {1e-7, 0}},
};

const fbl_kind fbl_system = {"system", features, FBL_COUNT(features), legal, draw, laws, FBL_COUNT(laws)};
