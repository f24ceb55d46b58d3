/* system.c - random legal systems: bodies on every kind of joint, loops, springs, and the laws that they keep. */
#include "laws.h"

static const fbl_feature features[] = {
    {"bodies", {"one", "two", "three", "four", "five"}},
    {"tree", {"chain", "star", "mixed"}},
    {"at", {"hub", "tip", "+way"}},
    {"root", {"free", "rigid", "revolute", "spherical", "driven"}},
    {"joint", {"revolute", "prismatic", "cylindrical", "screw", "universal", "spherical", "rigid", "free", "all"}},
    {"mode", {"free", "locked", "prescribed", "some"}},
    {"effort", {"none", "spring", "motor", "friction", "stop"}},
    {"loop", {"none", "ball", "hinge", "several", "planar"}},
    {"spring", {"none", "between", "ground", "pull", "+cord", "+moored"}},
    {"frame", {"plain", "turned", "axis", "+square"}},
    {"body", {"solid", "full", "rigid", "linear", "spin", "large", "mixed", "+strain"}},
    {"made", {"beam", "offset", "lumps", "import", "welded", "two"}},
    {"rotors", {"none", "hub", "boom", "rubbing", "unbalanced", "given"}},
    {"gravity", {"none", "uniform", "center"}},
    {"damping", {"none", "damped"}},
    {"load", {"none", "dead", "follower", "hub", "distributed"}},
    {"wheel", {"none", "wheel"}},
    {"motion", {"slow", "spinning", "flight"}},
    {"method", {"recursive", "dense", "loops"}},
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
enum { ON_HUB = 0, ON_TIP, ON_WAY };
enum { ROOT_FREE, ROOT_RIGID, ROOT_REVOLUTE, ROOT_SPHERICAL, ROOT_DRIVEN };
enum { ALL_JOINTS = 8, FREE_JOINTS = 7 };
enum { SOME_MODES = 3 };
enum { NO_EFFORT, SPRUNG, MOTOR, FRICTION, STOP };
enum { NO_LOOP, BALL, HINGE, SEVERAL, PLANAR };
enum { NO_SPRING, BETWEEN, TO_GROUND, PULL, CORD, MOORED };
enum { PLAIN, TURNED, BY_AXIS, SQUARE };
enum { SOLID, FULL, COUPLED, LINEAR, SPIN, LARGE, MIXED, STRAIN };
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
static int joint_slot[BODIES_MOST], n_as_loops; /* numbers of the tree's joints; how many of them are loops */
static fb_joint_kind kind[BODIES_MOST];
static fb_system_desc desc;
static fb_system mechanism;
static fb_system_work work;
static fb_system_state state; /* where the motion starts */
static fb_link_motion start[BODIES_MOST];
static fb_row held; /* the caller's constraint: O of a body stays at a distance from a place on the ground */
static int held_side;
static fb_real held_place[3];
static double size;
static double amplitude = 1.0; /* of the motion and of what acts: for laws of small motions */
static double wheels = 1.0;    /* of the speeds of rotors */

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
  case STRAIN:
    return FBL_STRAIN;
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
  static const fb_joint_kind root[] = {FB_JOINT_FREE, FB_JOINT_RIGID, FB_JOINT_REVOLUTE, FB_JOINT_SPHERICAL,
                                       FB_JOINT_FREE};
  static const fb_joint_kind other[] = {FB_JOINT_REVOLUTE,  FB_JOINT_PRISMATIC, FB_JOINT_CYLINDRICAL, FB_JOINT_SCREW,
                                        FB_JOINT_UNIVERSAL, FB_JOINT_SPHERICAL, FB_JOINT_RIGID,       FB_JOINT_FREE};
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

/* Free axes of the joints on the ways of loops first .. to the ground (a free root counts none), each once, less what
   the loops hold. */
static int freedom(const int *level, int first)
{
  int n = 0, used[BODIES_MOST] = {0};
  for (int l = first; l < loops_of(level); l++) {
    int end[2];
    loop_ends(level, l, &end[0], &end[1]);
    for (int e = 0; e < 2; e++) {
      for (int k = end[e]; k >= 0; k = k == 0 ? FB_GROUND : parent_of(level, k)) {
        for (int i = 0; i < axes_of(kind_of(level, k)) && !used[k]; i++) {
          n += (k > 0 || is_grounded(level)) &&
               mode_of(level, k, kind_of(level, k) == FB_JOINT_SPHERICAL ? 0 : i) == FB_AXIS_FREE;
        }
        used[k] = 1;
      }
    }
    n -= 6 - axes_of(loop_kind(level, l));
  }
  return n;
}

/* Level of METHOD: recursive, all bodies free, the joints of the tree are loops behind those of the scene. */
enum { AS_LOOPS = FB_METHOD_COUNT };

/* Is there room for the joints of the tree as loops, and for their constraints? */
static int may_be_loops(const int *level)
{
  int n = level[CALLBACK] == ROWS, joints = loops_of(level) + (level[WHEEL] != 0), last = bodies_of(level);
  for (int k = 0; k < last; k++) {
    const fb_joint_kind own = kind_of(level, k);
    n += 6 - axes_of(own);
    joints += own != FB_JOINT_FREE;
    for (int i = 0; i < axes_of(own); i++) {
      n += mode_of(level, k, is_ball(own) ? 0 : i) != FB_AXIS_FREE;
    }
  }
  for (int l = 0; l < loops_of(level); l++) {
    n += 6 - axes_of(loop_kind(level, l));
  }
  return n + (level[WHEEL] ? 5 : 0) <= FB_MAX_ROWS && joints <= FB_MAX_LOOPS;
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
  if (level[LOOP] == SEVERAL && level[TREE] == 1 && n < 4) { /* each between two bodies of its own */
    level[LOOP] = BALL;
  }
  level[LOOP] = level[LOOP] == SEVERAL && n < 3 ? BALL : n < 2 ? NO_LOOP : level[LOOP];
  while (level[LOOP] != NO_LOOP && level[LOOP] != PLANAR && (freedom(level, 0) < 1 || freedom(level, 1) < 0)) {
    level[LOOP]--;
  }
  if (level[METHOD] == AS_LOOPS && !may_be_loops(level)) {
    level[METHOD] = FB_METHOD_DENSE;
  }
  if (level[BODY] == LARGE && level[MADE] == WELDED) { /* more points than there is room for */
    level[MADE] = BEAM;
  }
  if (level[MOTION] == FLIGHT && level[CALLBACK] == ROWS) { /* to a plane of the ground */
    level[CALLBACK] = NO_CALLBACK;
  }
  if (level[MOTION] == FLIGHT && level[ROOT] == ROOT_FREE &&
      level[SPRING] != NO_SPRING) { /* the ground is left behind */
    level[SPRING] = n > 1 ? BETWEEN : NO_SPRING;
  }
  if (level[SPRING] == MOORED && level[ROOT] != ROOT_FREE && level[ROOT] != ROOT_DRIVEN) {
    level[SPRING] = TO_GROUND;
  }
  if (level[BODY] == SOLID) {
    level[MADE] = level[ROTORS] = level[DAMPING] = 0;
  }
  if (level[LOAD] == DISTRIBUTED && level[BODY] != LARGE) {
    level[LOAD] = DEAD;
  }
  if (level[GRAVITY] == FBL_CENTER && (level[BODY] == LINEAR || level[BODY] == SPIN || level[BODY] == STRAIN)) {
    level[GRAVITY] = FBL_GRAVITY;
  }
  if (level[ROOT] != ROOT_FREE && level[CALLBACK] == ROWS) { /* what the plane is for may have no other way to go */
    level[CALLBACK] = NO_CALLBACK;
  }
  if ((level[ROOT] != ROOT_FREE || level[BODY] == LINEAR || level[BODY] == SPIN) && level[MOTION] == FLIGHT) {
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
  fbl_polar(center, round ? 0.0 : fbl_in(0.1, 0.3), round ? 0.0 : fbl_in(-0.2, 0.2), round ? 0.0 : fbl_in(-0.2, 0.2), 0,
            1, 0);
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

static fb_status models_make(const int *level)
{
  fb_status status = FB_OK;
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

/* The model of body s of the system. */
static const fb_body *model_at(int s)
{
  return &model[desc.model[s]];
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
  } else if (now[FRAME] == SQUARE && !ground) { /* along an axis of both bodies: x, y, z, -x, -y */
    const int i = fbl_pick(5), along = i % 3;
    const double sign = i < 3 ? 2.0 : -0.7;
    fbl_polar(d->axis, along == 0 ? sign : 0.0, along == 1 ? sign : 0.0, along == 2 ? sign : 0.0, 0, 0, 0);
    memcpy(d->child_axis, d->axis, sizeof d->child_axis);
  } else if (ground && now[LOOP] == PLANAR) {
    const double level_[4] = {1.0, 0.0, 0.0, 0.0};
    fbl_quat(d->attitude, level_, 1);
  } else if (now[FRAME] == TURNED || ground) {
    attitude_draw(d->attitude, 0.8, ground);
    attitude_draw(d->child_attitude, 0.8, 0);
  }
}

/* Springs and dampers of the root, near the pose where its motion starts. */
static void mooring_draw(fb_joint_desc *d)
{
  fb_real q[4];
  fbl_stream("start");
  attitude_draw(q, 0.8, 1);
  place_draw(d->rest, 0.5, 1);
  fb_quat_to_rotvec(d->rest + 3, q);
  fbl_stream("mooring");
  for (int i = 0; i < 6; i++) {
    const int turns = i > 2;
    const double sign = fbl_seen.mirror && (i == 1 || i == 3 || i == 5) ? -1.0 : 1.0;
    const double off = sign * amplitude * fbl_in(-0.3, 0.3), k = fbl_in(2.0, 8.0), c = fbl_in(0.1, 1.0);
    d->rest[i] += turns ? (fb_real)off : fbl_unit(off, 0, 1, 0);
    d->stiffness[i] = fbl_unit(k, 1, turns ? 2 : 0, -2);
    d->damping[i] = fbl_unit(c, 1, turns ? 2 : 0, -1);
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
    if (now[SPRING] == MOORED) {
      mooring_draw(d);
    }
    return;
  }
  if (d->kind == FB_JOINT_FREE) {
    d->parent = FB_GROUND;
    return;
  }
  if (!ground && !wheel) {
    d->parent_node = now[AT] == ON_WAY ? body(parent[k])->n_node - 1 : now[AT] == ON_TIP;
  }
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
    if (now[FRAME] >= BY_AXIS) {
      d->child_axis[2] = FB_R(1.0);
    }
  } else {
    effort_draw(d);
  }
}

static void springs_draw(void)
{
  const int two = now[SPRING] == PULL || now[SPRING] == BETWEEN, n = n_body - (now[WHEEL] != 0);
  desc.n_spring = now[SPRING] == NO_SPRING || now[SPRING] == MOORED ? 0 : now[SPRING] == PULL ? 2 : 1;
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
    if (now[SPRING] == CORD) { /* from the body to the ground, its points may meet */
      const fb_spring own = *s;
      s->length = s->damping = FB_R(0.0);
      for (int e = 0; e < 2; e++) {
        s->body[e] = own.body[1 - e];
        s->node[e] = own.node[1 - e];
        memcpy(s->position[e], own.position[1 - e], sizeof own.position[0]);
      }
    }
  }
}

/* ---- inputs at the drawn time t */

typedef struct wave {
  double x, rate, acceleration;
} wave;

static wave wave_at(double t, double size_of)
{
  const double w = fbl_in(0.5, 2.0), phase = fbl_in(-1.5, 1.5), a = amplitude * size_of * fbl_in(0.5, 1.0);
  wave out;
  out.x = a * sin(w * t + phase);
  out.rate = a * w * cos(w * t + phase);
  out.acceleration = -a * w * w * sin(w * t + phase);
  return out;
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

/* Direction from the place to a body's O; returns the distance. */
static double held_along(fb_real along[3], const fb_real *position)
{
  double distance;
  for (int i = 0; i < 3; i++) {
    along[i] = position[i] - held_place[i];
  }
  distance = sqrt(dot(along, along));
  for (int i = 0; i < 3; i++) {
    along[i] /= (fb_real)distance;
  }
  return distance;
}

static int rows(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user)
{
  (void)t, (void)user;
  if (capacity < 1) {
    return FB_ERR_CAPACITY;
  }
  *row = held;
  row->value += (fb_real)held_along(row->force[held_side], pose[held.body[held_side]].position);
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
  const double all = 1.0 + wave_at(t, 0.5).x, most = amplitude * (now[LOAD] == NO_LOAD ? 0.0 : 3.0);
  const double force = all * most, torque = 0.3 * force;
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
  const int n_loop = desc.n_loop - n_as_loops;
  memset(in, 0, sizeof *in);
  in->t = fbl_unit(t, 0, 0, 1);
  for (int j = 0; j < n_body + n_loop; j++) {
    fbl_number = 1 + (j < n_body ? j : BODIES_MOST + j - n_body);
    fbl_stream("drive");
    if (j < n_body) {
      const int of = joint_slot[j];
      drive_fill(&in->drive[of], kind[j], of < n_body ? desc.joint[of].mode : desc.loop[of - n_body].mode, t);
    } else {
      const int l = fbl_seen.reverse ? n_loop - 1 - (j - n_body) : j - n_body;
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
  in->distributed = now[LOAD] == DISTRIBUTED ? fbl_wind : NULL;
  in->user = &size;
  in->forces = now[CALLBACK] == FORCES ? forces : NULL;
  in->rows = now[CALLBACK] == ROWS ? rows : NULL;
}

/* ---- state */

static void start_draw(int k)
{
  fb_link_motion *const m = &start[slot[k]];
  const int wheel = now[WHEEL] && k == n_body - 1;
  const double fast = amplitude * (now[MOTION] == SLOW ? 0.2 : 1.5);
  const double speed = amplitude * (now[MOTION] == FLIGHT ? 400.0 : 0.3);
  fbl_number = 1 + k;
  memset(m, 0, sizeof *m);
  fbl_deflect(m->q, m->q_dot, body(k), size_made[model_of(k)]);
  for (int a = 0; a < body(k)->n; a++) {
    m->q[a] *=
        (fb_real)(0.5 * amplitude); /* farther from where the foreshortening of several modes takes the inertia */
    m->q_dot[a] *= (fb_real)amplitude;
    if (!(body(k)->reach[a] > FB_R(0.0))) { /* torsion: by its angles, which give the coordinate its unit */
      double most = 0.0;
      for (int n = 0; n < body(k)->n_node; n++) {
        most = larger(most, fbl_largest(&body(k)->node[n].theta[3 * a], 3));
      }
      fbl_stream("torsion");
      m->q[a] = (fb_real)((fbl_seen.undeformed ? 0.0 : amplitude * 0.05 * fbl_in(-1.0, 1.0)) / most);
      m->q_dot[a] =
          (fb_real)((fbl_seen.undeformed ? 0.0 : amplitude * (double)fbl_unit(0.2 * fbl_in(-1.0, 1.0), 0, 0, -1)) /
                    most);
    }
  }
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
    attitude_draw(m->quat, 0.2 * amplitude, 0);
    fbl_axial(m->speed, fbl_in(-fast, fast), fbl_in(-fast, fast), fbl_in(-fast, fast), 0, 0, -1);
  } else {
    for (int i = 0; i < axes_of(kind[k]); i++) {
      m->value[i] = seen_axis(kind[k], i, amplitude * fbl_in(-0.5, 0.5), 0, 0);
      m->speed[i] = seen_axis(kind[k], i, wheel ? amplitude * fbl_in(10.0, 40.0) : fbl_in(-fast, fast), 0, -1);
    }
  }
  fbl_stream("wheels");
  for (int r = 0; r < body(k)->n_rotor; r++) {
    m->rotor_speed[r] = fbl_unit(wheels * amplitude * fbl_in(-60.0, 60.0), 0, 0, -1);
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
  fb_system_limit limit;
  fbl_points told;
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

/* The row names the ground, or the first body, on which it does not act, on the other side. */
static void held_draw(const look *at)
{
  const int k = bodies_of(now) - 1;
  fb_real along[3];
  fbl_number = 0;
  fbl_stream("row");
  memset(&held, 0, sizeof held);
  held_side = fbl_pick(2);
  held.body[held_side] = slot[k];
  held.body[1 - held_side] = k > 0 && fbl_pick(2) ? slot[0] : FB_GROUND;
  held.holonomic = 1;
  fbl_inertial_polar(held_place, 0.7, -0.9, 1.0, 0, 1, 0);
  for (int i = 0; i < 3; i++) {
    held_place[i] += at->motion.pose[slot[k]].rho[i];
  }
  held.value = -(fb_real)held_along(along, at->motion.pose[slot[k]].rho);
}

/* Writes the joints of the tree as loops of free bodies, from the state on. */
static fb_status joints_to_loops(void)
{
  static fb_system_input in;
  static fb_system_motion at;
  fb_status status;
  input_fill(&in, 0.0);
  status = fb_system_motion_eval(&mechanism, model, &work, &at, &state, &in);
  for (int k = 0; k < n_body && status == FB_OK; k++) {
    const int s = slot[k];
    fb_link_motion *const m = &start[s];
    if (kind[k] != FB_JOINT_FREE) {
      fb_joint_desc *const loop = &desc.loop[desc.n_loop];
      *loop = desc.joint[s];
      loop->child = s;
      memset(&desc.joint[s], 0, sizeof desc.joint[s]);
      joint_slot[k] = n_body + desc.n_loop++;
      n_as_loops++;
    }
    memcpy(m->value, at.pose[s].rho, sizeof m->value);
    memcpy(m->quat, at.pose[s].quat, sizeof m->quat);
    memcpy(m->speed, at.motion[s].v, 3 * sizeof m->speed[0]);
    memcpy(m->speed + 3, at.motion[s].w, 3 * sizeof m->speed[0]);
    memcpy(m->q, at.pose[s].q, (size_t)body(k)->n * sizeof m->q[0]);
    memcpy(m->q_dot, at.motion[s].q_dot, (size_t)body(k)->n * sizeof m->q_dot[0]);
  }
  input_fill(&in, 0.0);
  status = status ? status : system_make();
  return status ? status : state_draw(&in);
}

static fb_status draw_levels(const int *level)
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
  desc.method = level[METHOD] == FB_METHOD_DENSE ? FB_METHOD_DENSE : FB_METHOD_RECURSIVE;
  memcpy(joint_slot, slot, sizeof joint_slot);
  n_as_loops = 0;
  for (int k = 0; k < n_body; k++) {
    desc.model[slot[k]] = model_slot[model_of(k)];
    joint_draw(k);
    start_draw(k);
  }
  springs_draw();
  input_fill(&in, 0.0);
  if (loops_of(level) > 0 || level[CALLBACK] == ROWS) {
    const fb_rows own = in.rows;
    const fb_method method = desc.method;
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
    desc.method = method;
    input_fill(&in, 0.0);
  }
  fbl_number = 0;
  status = system_make();
  status = status ? status : state_draw(&in);
  return status || level[METHOD] != AS_LOOPS ? status : joints_to_loops();
}

static fb_status draw(const int *level)
{
  amplitude = 1.0;
  return draw_levels(level);
}

/* ---- five states that follow each other, and all that can be asked of them */

static look path[5];
static fb_system_input input; /* at path[2] */
static double dt;

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
  for (int r = 0; r < body(k)->n_rotor; r++) {
    out->pi[body(k)->n + r] = m->rotor_momentum[r];
  }
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
  fb_status status;
  memset(&fbl_told, 0, sizeof fbl_told);
  status = fb_system_motion_eval(&mechanism, model, &work, &at->motion, where, in);
  at->told = fbl_told;
  at->state = *where;
  status = status ? status : nodes_look(at);
  status = status ? status : fb_system_limit_eval(&mechanism, model, &work, &at->limit, where, in);
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

/* The longest step of rk4, implicit: of sdirk, too. */
static double step_of(fb_status *status, int implicit)
{
  static fb_system_input in;
  fb_system_limit limit;
  double most = (double)fbl_unit(0.1, 0, 0, 1);
  input_fill(&in, 0.0);
  *status = fb_system_limit_eval(&mechanism, model, &work, &limit, &state, &in);
  if (*status == FB_OK) {
    most = (double)limit.rk4 < most ? (double)limit.rk4 : most;
    most = implicit && (double)limit.sdirk < most ? (double)limit.sdirk : most;
  }
  return most;
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
  dt = h * step_of(&status, 0);
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

/* ---- laws ask a model near to the drawn one if they would say nothing of that */

/* Puts the levels from .. to of a feature at another one. */
static void put(int *level, int feature, int from, int to, int at)
{
  level[feature] = level[feature] >= from && level[feature] <= to ? at : level[feature];
}

/* Draws with other levels, if they are others. */
static fb_status near_by(int *level)
{
  legal(level);
  return memcmp(level, now, N_FEATURE * sizeof *level) == 0 ? FB_OK : draw(level);
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
      fbl_turning(w, path[0].node[k][n].quat, sizeof(look) / sizeof(fb_real), dt);
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

/* What a distributed load is told of the lines. */
static double points(double h)
{
  FBL_TRY(walk(h));
  return now[LOAD] == DISTRIBUTED ? fbl_points_miss(&path[0].told, sizeof(look) / sizeof(fb_real), dt, size) : FBL_NONE;
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
    miss = larger(miss, fbl_difference(off[0], imu.specific_force, 3) /
                            (fbl_largest(a, 3) + (double)fbl_unit(size, 0, 1, -2)));
    miss = larger(miss,
                  fbl_difference(off[1], imu.angular_rate, 3) / (fbl_largest(w, 3) + (double)fbl_unit(1.0, 0, 0, -1)));
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
    for (int i = 0; i < axes_of(joint->kind) && joint->kind != FB_JOINT_FREE; i++) {
      const double second = (double)fbl_unit(1.0, 0, slides(joint->kind, i), -1);
      const int jumps = fabs((double)path[4].motion.joint[j].value[i] - (double)path[0].motion.joint[j].value[i]) > 1.0;
      if (!is_ball(joint->kind) && !jumps) {
        miss = larger(miss, fabs(SLOPE(motion.joint[j].value[i]) - (double)at->speed[i]) /
                                (fabs((double)at->speed[i]) + second));
      }
      if (j < n_body) {
        const double unit = (double)fbl_unit(1.0, 0, slides(joint->kind, i), -2);
        miss = larger(miss, fabs(SLOPE(motion.joint[j].speed[i]) - (double)at->acceleration[i]) /
                                (fabs((double)at->acceleration[i]) + unit));
      }
    }
  }
  return miss;
}

/* ---- laws: balances */

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
  const double depth = x < (double)d->stop[i][0]   ? x - (double)d->stop[i][0]
                       : x > (double)d->stop[i][1] ? x - (double)d->stop[i][1]
                                                   : 0.0;
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

/* Force and moment of the springs and dampers of the root on it at O, inertial axes, by virtual work: a rotation about each
   axis changes the rotation vector; 0: none, or what prescribes the root acts, too. lost: the power of the dampers. */
static int mooring_pull(double *lost, fb_real force[3], fb_real torque[3])
{
  const int s = slot[0];
  const fb_joint *const d = &mechanism.joint[s];
  const fb_state *const pose = &path[2].motion.pose[s];
  const fb_real *const v = path[2].node[0][0].velocity, *const w = path[2].motion.motion[s].w;
  const double small = 1e-4;
  fb_real drag[3], axes[3];
  *lost = 0.0;
  if (now[SPRING] != MOORED) {
    return 0;
  }
  for (int i = 0; i < 3; i++) {
    force[i] = -d->stiffness[i] * (pose->rho[i] - d->rest[i]) - d->damping[i] * v[i];
    drag[i] = -d->damping[3 + i] * w[i];
    *lost += (double)(drag[i] * w[i]) - (double)(d->damping[i] * v[i] * v[i]);
  }
  to_inertial(axes, pose->quat, drag);
  for (int i = 0; i < 3; i++) {
    fb_real U[5];
    for (int p = 0; p < 5; p++) {
      fb_real turn[3] = {0}, by[4], q[4], theta[3];
      turn[i] = (fb_real)(small * (p - 2));
      fb_quat_from_rotvec(by, turn);
      fb_quat_mul(q, by, pose->quat);
      fb_quat_to_rotvec(theta, q);
      U[p] = FB_R(0.0);
      for (int k = 0; k < 3; k++) {
        U[p] += FB_R(0.5) * d->stiffness[3 + k] * (theta[k] - d->rest[3 + k]) * (theta[k] - d->rest[3 + k]);
      }
    }
    torque[i] = axes[i] - (fb_real)fbl_slope(U, 1, small);
  }
  return path[2].state.mode[s][0] == FB_AXIS_FREE;
}

static double joint_losses(void)
{
  double sum;
  fb_real force[3], torque[3];
  (void)mooring_pull(&sum, force, torque);
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
        sum -= (double)rotor->friction * u * u /
               sqrt(u * u + (double)rotor->friction_speed * (double)rotor->friction_speed);
      }
    }
  }
  return sum;
}

static double energy_rate(double h)
{
  double rate, power, size_of;
  int level[FBL_FEATURES];
  memcpy(level, now, sizeof level);
  put(level, ROTORS, FBL_UNBALANCED, FBL_GIVEN, FBL_RUBBING);
  put(level, LOAD, DISTRIBUTED, DISTRIBUTED, FOLLOWER);
  FBL_TRY(near_by(level));
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
  return fabs(rate - power) / (size_of + (double)path[2].energy.kinetic * (double)fbl_unit(1.0, 0, 0, -1) +
                               (double)fbl_unit(1e-3, 1, 2, -3));
}

/* Power of motors and actuators, and of what prescribes axes, from what each of them does. */
static double powers(double h)
{
  const look *const at = &path[2];
  double motors = 0.0, given = 0.0, all = 0.0, unit = (double)fbl_unit(1.0, 1, 2, -3);
  FBL_TRY(walk(h));
  for (int j = 0; j < n_body + desc.n_loop; j++) {
    const fb_joint *const d = &mechanism.joint[j];
    const fb_joint_motion *const m = &at->motion.joint[j];
    for (int i = 0; i < axes_of(d->kind); i++) {
      const fb_axis_mode mode = at->state.mode[j][is_ball(d->kind) ? 0 : i];
      double lost, motor;
      if (d->kind == FB_JOINT_FREE) {
        continue;
      }
      motor = ((double)m->drive[i] - effort(&lost, j, i)) * (double)m->speed[i];
      motors += mode == FB_AXIS_FREE ? motor : 0.0;
      given += mode == FB_AXIS_PRESCRIBED ? motor : 0.0;
      all += fabs(motor);
    }
  }
  for (int j = 0; j < desc.n_spring; j++) {
    const fb_spring *const s = &mechanism.spring[j];
    const fb_spring_motion *const m = &at->motion.spring[j];
    const double pull = (double)m->tension - (double)s->stiffness * ((double)m->length - (double)s->length) -
                        (double)s->damping * (double)m->rate;
    motors -= pull * (double)m->rate;
    all += fabs(pull * (double)m->rate);
  }
  for (int k = 0; k < n_body; k++) {
    for (int r = 0; r < body(k)->n_rotor; r++) {
      const double p = body(k)->rotor[r].given
                           ? 0.0
                           : (double)input.rotor[slot[k]][r].torque * (double)at->motion.motion[slot[k]].rotor_speed[r];
      motors += p;
      all += fabs(p);
    }
  }
  all += fabs((double)at->motion.power) + unit;
  if (now[ROOT] == ROOT_DRIVEN || now[ROTORS] == FBL_GIVEN) {
    return fabs(SLOPE(state.motor_work) - motors) / all;
  }
  return larger(fabs(SLOPE(state.motor_work) - motors), fabs((double)at->motion.power - motors - given)) / all;
}

/* Where the joint frame on the child is, and its axes; inertial axes. */
static void joint_frame(double origin[3], fb_real R[9], int j, int parent_side)
{
  const fb_joint *const d = &mechanism.joint[j];
  const int s = parent_side ? d->parent : j < n_body ? j : d->child;
  fb_real axes[9], arm[3], x[3] = {0};
  const fb_real *const p = parent_side ? d->position : d->child_position;
  if (s < 0) {
    memcpy(R, d->axes, 9 * sizeof *R);
    memcpy(arm, p, sizeof arm);
  } else {
    const fb_node_motion *const node = &path[2].node[body_of[s]][parent_side  ? d->parent_node
                                                                 : j < n_body ? 0
                                                                              : d->child_node];
    fb_quat_to_mat33(axes, node->quat);
    fb_mat33_mul(R, axes, parent_side ? d->axes : d->child_axes);
    fb_mat33_mul_vec3(arm, axes, p);
    memcpy(x, node->position, sizeof x);
  }
  for (int i = 0; i < 3; i++) {
    origin[i] = (double)x[i] + (double)arm[i];
  }
}

/* Unit vector of axis i of a joint. */
static void axis_now(fb_real a[3], int j, int i)
{
  const fb_joint_kind k = mechanism.joint[j].kind;
  double origin[3];
  fb_real R[9];
  const int column = k == FB_JOINT_SPHERICAL ? i : k == FB_JOINT_UNIVERSAL && i == 1 ? 0 : 2;
  joint_frame(origin, R, j, k == FB_JOINT_UNIVERSAL && i == 0);
  for (int r = 0; r < 3; r++) {
    a[r] = R[3 * r + column];
  }
}

/* Joints act along their axes with motor, spring, damper, friction and stops, or with what holds the axis. */
static double efforts(double h)
{
  double miss = 0.0;
  FBL_TRY(walk(h));
  for (int j = 0; j < n_body + desc.n_loop; j++) {
    const fb_joint *const d = &mechanism.joint[j];
    const fb_joint_motion *const m = &path[2].motion.joint[j];
    const double f_size = fbl_largest(m->force, 3), t_size = fbl_largest(m->torque, 3);
    for (int i = 0; i < axes_of(d->kind) && d->kind != FB_JOINT_FREE; i++) {
      const int slide = slides(d->kind, i);
      const double unit =
          (slide ? f_size : t_size + f_size * fabs((double)d->pitch)) + (double)fbl_unit(1.0, 1, slide ? 1 : 2, -2);
      double lost, acts;
      fb_real a[3];
      axis_now(a, j, i);
      acts = slide ? dot(a, m->force) : dot(a, m->torque) + (double)d->pitch * dot(a, m->force);
      miss = larger(miss, fabs(acts - (double)m->drive[i]) / unit);
      if (path[2].state.mode[j][is_ball(d->kind) ? 0 : i] == FB_AXIS_FREE) {
        double motor = (double)input.drive[j].torque[i];
        motor -= now[CALLBACK] == FORCES ? (double)fbl_unit(0.3, 1, slide ? 0 : 2, -1) * (double)m->speed[i] : 0.0;
        miss = larger(miss, fabs(motor + effort(&lost, j, i) - (double)m->drive[i]) / unit);
      }
    }
  }
  return miss;
}

/* -dU/d(shift), -dU/d(rotation about the inertial origin) of the energy of gravity of body k: its force and moment. */
static double gravity_slope(int k, int i, int rotate)
{
  const double d = rotate ? 1e-3 : 1e-3 * (double)fbl_unit(size, 0, 1, 0);
  static fb_input none;
  fb_real U[5];
  if (!(body(k)->effects & (FB_EFFECT_GRAVITY | FB_EFFECT_CENTRAL_GRAVITY))) {
    return 0.0;
  }
  memcpy(none.rotor, input.rotor[slot[k]], sizeof none.rotor);
  for (int p = 0; p < 5; p++) {
    fb_state at = path[2].motion.pose[slot[k]];
    fb_energy energy;
    fb_real turn[3] = {0}, q[4], R[9];
    if (rotate) {
      turn[i] = (fb_real)(d * (p - 2));
      fb_quat_from_rotvec(q, turn);
      fb_quat_to_mat33(R, q);
      fb_mat33_mul_vec3(at.rho, R, path[2].motion.pose[slot[k]].rho);
      fb_quat_mul(at.quat, q, path[2].motion.pose[slot[k]].quat);
    } else {
      at.rho[i] += (fb_real)(d * (p - 2));
    }
    if (fb_body_energy_eval(body(k), &energy, &at, &none) != FB_OK) {
      return HUGE_VAL;
    }
    U[p] = energy.gravity;
  }
  return -fbl_slope(U, 1, d);
}

typedef struct pair { /* force and moment about the inertial origin, with the sums of their sizes */
  double force[3], moment[3], f_size, m_size;
} pair;

static void add(pair *p, double sign, const double at[3], const fb_real f[3], const fb_real t[3])
{
  for (int i = 0; i < 3; i++) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double arm = at[j] * (double)f[k] - at[k] * (double)f[j];
    p->force[i] += sign * (double)f[i];
    p->moment[i] += sign * ((double)t[i] + arm);
    p->f_size = larger(p->f_size, fabs((double)f[i]));
    p->m_size = larger(p->m_size, larger(fabs((double)t[i]), fabs(arm)));
  }
}

/* Where end e of spring j is. */
static void spring_end(double x[3], int j, int e)
{
  const fb_spring *const s = &mechanism.spring[j];
  if (s->body[e] < 0) {
    for (int i = 0; i < 3; i++) {
      x[i] = (double)s->position[e][i];
    }
  } else {
    const fb_node_motion *const node = &path[2].node[body_of[s->body[e]]][s->node[e]];
    fb_real arm[3];
    to_inertial(arm, node->quat, s->position[e]);
    for (int i = 0; i < 3; i++) {
      x[i] = (double)node->position[i] + (double)arm[i];
    }
  }
}

/* Force of spring j on its first end, now, and where both are. */
static void spring_pull(fb_real f[3], double x[2][3], int j)
{
  double length = 0.0;
  spring_end(x[0], j, 0);
  spring_end(x[1], j, 1);
  for (int i = 0; i < 3; i++) {
    length += (x[1][i] - x[0][i]) * (x[1][i] - x[0][i]);
  }
  for (int i = 0; i < 3; i++) {
    f[i] = (fb_real)((x[1][i] - x[0][i]) / sqrt(length) * (double)path[2].motion.spring[j].tension);
  }
}

/* All that acts on each body of the system, [n_body]: of all of it, by the ground and from outside. */
static void act(pair total[BODIES_MOST + 1])
{
  static const fb_real none[3] = {0};
  memset(total, 0, (BODIES_MOST + 1) * sizeof *total);
  for (int j = 0; j < n_body + desc.n_loop; j++) {
    const fb_joint *const d = &mechanism.joint[j];
    double x[3], lost;
    fb_real R[9], force[3], torque[3];
    joint_frame(x, R, j, 0);
    if (j != slot[0] || !mooring_pull(&lost, force, torque)) {
      memcpy(force, path[2].motion.joint[j].force, sizeof force);
      memcpy(torque, path[2].motion.joint[j].torque, sizeof torque);
    }
    add(&total[j < n_body ? j : d->child], 1.0, x, force, torque);
    add(&total[d->parent < 0 ? n_body : d->parent], d->parent < 0 ? 1.0 : -1.0, x, force, torque);
  }
  for (int k = 0; k < input.n_load; k++) {
    fb_real f[3], t[3];
    const fb_node_motion *const node = load_now(f, t, k);
    const double x[3] = {(double)node->position[0], (double)node->position[1], (double)node->position[2]};
    add(&total[input.load[k].body], 1.0, x, f, t);
    add(&total[n_body], 1.0, x, f, t);
  }
  for (int j = 0; j < desc.n_spring; j++) {
    double x[2][3];
    fb_real f[3];
    spring_pull(f, x, j);
    for (int e = 0; e < 2; e++) {
      const int s = mechanism.spring[j].body[e];
      if (s >= 0) {
        add(&total[s], e ? -1.0 : 1.0, x[e], f, none);
      } else {
        add(&total[n_body], e ? 1.0 : -1.0, x[e], f, none); /* as it acts on the other end */
      }
    }
  }
  for (int s = 0; s < n_body; s++) {
    for (int i = 0; i < 3; i++) {
      const double f = gravity_slope(body_of[s], i, 0), t = gravity_slope(body_of[s], i, 1);
      for (int all = 0; all < 2; all++) {
        pair *const p = &total[all ? n_body : s];
        p->force[i] += f;
        p->moment[i] += t;
        p->f_size = larger(p->f_size, fabs(f));
        p->m_size = larger(p->m_size, fabs(t));
      }
    }
  }
}

/* Inertia that does not follow the shape depends on the point about which it is taken: a body in a system about its O,
   alone about its mass center (fb_effects_check). */
static int is_crude(void)
{
  return now[BODY] == LINEAR || now[BODY] == SPIN;
}

/* What acts from outside is known to the law. */
static fb_status known_loads(int crude)
{
  int level[FBL_FEATURES];
  memcpy(level, now, sizeof level);
  put(level, ROTORS, FBL_UNBALANCED, FBL_UNBALANCED, FBL_ON_BOOM);
  put(level, LOAD, DISTRIBUTED, DISTRIBUTED, FOLLOWER);
  put(level, CALLBACK, ROWS, ROWS, FORCES);
  if (!crude) {
    put(level, BODY, LINEAR, SPIN, FULL);
  }
  return near_by(level);
}

static double misses(const pair *p, const double rate[6], const fb_momentum *m)
{
  const double second = (double)fbl_unit(1.0, 0, 0, -1);
  const double f = p->f_size + (fbl_largest(m->linear, 3) + (double)fbl_unit(1.0, 1, 1, -1)) * second;
  const double t = p->m_size + (fbl_largest(m->angular, 3) + (double)fbl_unit(1.0, 1, 2, -1)) * second;
  double miss = 0.0;
  for (int i = 0; i < 3; i++) {
    miss = larger(miss, fabs(rate[i] - p->force[i]) / f);
    miss = larger(miss, fabs(rate[3 + i] - p->moment[i]) / t);
  }
  return miss;
}

/* Momenta of each body change by its joints, loads, springs and gravity. */
static double momenta_of_bodies(double h)
{
  static pair total[BODIES_MOST + 1];
  double miss = 0.0;
  FBL_TRY(known_loads(0));
  FBL_TRY(walk(h));
  act(total);
  for (int k = 0; k < n_body; k++) {
    double rate[6];
    if (now[ROOT] == ROOT_DRIVEN && k == 0) {
      continue; /* what drives it is the joint's, a free joint's is not looked at */
    }
    for (int i = 0; i < 3; i++) {
      rate[i] = SLOPE(body[k].linear[i]);
      rate[3 + i] = SLOPE(body[k].angular[i]);
    }
    miss = larger(miss, misses(&total[slot[k]], rate, &path[2].body[k]));
  }
  return miss;
}

/* Of the whole by what comes from outside; its momentum is the sum of those of the bodies. */
static double momenta(double h)
{
  static pair total[BODIES_MOST + 1];
  double rate[6], sum[6] = {0}, scale[2] = {0};
  double miss = 0.0;
  FBL_TRY(known_loads(1));
  FBL_TRY(walk(h));
  for (int k = 0; k < n_body; k++) {
    for (int i = 0; i < 3; i++) {
      sum[i] += (double)path[2].body[k].linear[i];
      sum[3 + i] += (double)path[2].body[k].angular[i];
    }
    scale[0] += fbl_largest(path[2].body[k].linear, 3);
    scale[1] += fbl_largest(path[2].body[k].angular, 3);
  }
  for (int i = 0; i < 3; i++) {
    if (is_crude()) {
      sum[i] = (double)path[2].momentum.linear[i];
      sum[3 + i] = (double)path[2].momentum.angular[i];
    }
    rate[i] = SLOPE(momentum.linear[i]);
    rate[3 + i] = SLOPE(momentum.angular[i]);
    miss =
        larger(miss, fabs(sum[i] - (double)path[2].momentum.linear[i]) / (scale[0] + (double)fbl_unit(1e-3, 1, 1, -1)));
    miss = larger(miss, fabs(sum[3 + i] - (double)path[2].momentum.angular[i]) /
                            (scale[1] + (double)fbl_unit(1e-3, 1, 2, -1)));
  }
  if (now[ROOT] == ROOT_DRIVEN) {
    return miss;
  }
  act(total);
  return larger(miss, misses(&total[n_body], rate, &path[2].momentum));
}

/* The resultant of the joints on each body is the reaction that its motion tells. */
static double reactions(double h)
{
  double miss = 0.0;
  FBL_TRY(walk(h));
  for (int s = 0; s < n_body; s++) {
    const fb_motion *const m = &path[2].motion.motion[s];
    const fb_state *const pose = &path[2].motion.pose[s];
    pair p;
    fb_real f[3], t[3];
    double f_off = 0.0, t_off = 0.0;
    memset(&p, 0, sizeof p);
    for (int j = 0; j < n_body + desc.n_loop; j++) {
      const fb_joint *const d = &mechanism.joint[j];
      const fb_joint_motion *const joint = &path[2].motion.joint[j];
      const int child = j < n_body ? j : d->child;
      double x[3];
      fb_real R[9];
      joint_frame(x, R, j, 0);
      for (int i = 0; i < 3; i++) {
        x[i] -= (double)pose->rho[i];
      }
      if (child == s || d->parent == s) {
        add(&p, child == s ? 1.0 : -1.0, x, joint->force, joint->torque);
      }
    }
    to_inertial(f, pose->quat, m->reaction_force);
    to_inertial(t, pose->quat, m->reaction_torque);
    if (now[CALLBACK] == ROWS &&
        s == held.body[held_side]) { /* and of the row, which pushes along its direction at O */
      fb_real along[3];
      double push = 0.0;
      (void)held_along(along, pose->rho);
      for (int i = 0; i < 3; i++) {
        push += ((double)f[i] - p.force[i]) * (double)along[i];
      }
      for (int i = 0; i < 3; i++) {
        f[i] -= (fb_real)push * along[i];
      }
      p.f_size = larger(p.f_size, fabs(push));
    }
    for (int i = 0; i < 3; i++) {
      f_off = larger(f_off, fabs((double)f[i] - p.force[i]));
      t_off = larger(t_off, fabs((double)t[i] - p.moment[i]));
    }
    miss = larger(miss, f_off / (p.f_size + (double)fbl_unit(1.0, 1, 1, -2)));
    miss = larger(miss, t_off / (p.m_size + (double)fbl_unit(1.0, 1, 2, -2)));
  }
  return miss;
}

static double over(const fb_real *a, const fb_real *b, int n, double unit)
{
  return fbl_difference(a, b, n) / (unit + fbl_largest(a, n));
}

/* ---- laws: internal loads of lines */

/* Adds a force and a moment about x, inertial axes, at a node of a body that is alone. */
static int load_add(fb_input *in, int k, int node, const double x[3], double sign, const fb_real f[3],
                    const fb_real t[3])
{
  fb_load *const load = &in->load[in->n_load];
  const fb_real *const at = path[2].node[k][node].position;
  if (in->n_load++ >= FB_MAX_LOADS) {
    in->n_load = FB_MAX_LOADS;
    return 0;
  }
  load->node = node;
  load->axes = FB_AXES_INERTIAL;
  for (int i = 0; i < 3; i++) {
    const int p = (i + 1) % 3, q = (i + 2) % 3;
    load->force[i] = (fb_real)(sign * (double)f[i]);
    load->torque[i] = (fb_real)(sign * ((double)t[i] + (x[p] - (double)at[p]) * (double)f[q] -
                                        (x[q] - (double)at[q]) * (double)f[p]));
  }
  return 1;
}

/* Node of body s that a joint or a spring is at. */
static int joint_node(int j, int s)
{
  const fb_joint *const d = &mechanism.joint[j];
  return s == d->parent ? d->parent_node : j < n_body ? 0 : d->child_node;
}

/* All that acts on body s but its own lines' load, as loads of a body that is alone. */
static int loads_of(fb_input *in, int s)
{
  const int k = body_of[s];
  int fits = 1;
  fb_real R[9];
  double x[2][3];
  for (int j = 0; j < n_body + desc.n_loop; j++) {
    const fb_joint *const d = &mechanism.joint[j];
    const fb_joint_motion *const m = &path[2].motion.joint[j];
    const int child = j < n_body ? j : d->child;
    joint_frame(x[0], R, j, 0);
    if (child == s || d->parent == s) {
      fits &= load_add(in, k, joint_node(j, s), x[0], child == s ? 1.0 : -1.0, m->force, m->torque);
    }
  }
  for (int l = 0; l < input.n_load; l++) {
    fb_real f[3], t[3];
    if (input.load[l].body == s) {
      const fb_node_motion *const node = load_now(f, t, l);
      const double at[3] = {(double)node->position[0], (double)node->position[1], (double)node->position[2]};
      fits &= load_add(in, k, input.load[l].load.node, at, 1.0, f, t);
    }
  }
  for (int j = 0; j < desc.n_spring; j++) {
    const fb_spring *const d = &mechanism.spring[j];
    static const fb_real none[3] = {0};
    fb_real f[3];
    spring_pull(f, x, j);
    for (int e = 0; e < 2; e++) {
      if (d->body[e] == s) {
        fits &= load_add(in, k, d->node[e], x[e], e ? -1.0 : 1.0, f, none);
      }
    }
  }
  return fits;
}

/* Lines of a body in a system bear what they bear in the same motion alone, with joints, springs and loads as loads at
   nodes; a node bears what the line does where it is. */
static double loads_within(double h)
{
  static fb_line_motion in_system[FB_MAX_LINE_POINTS], own[FB_MAX_LINE_POINTS];
  int level[FBL_FEATURES];
  double miss = 0.0;
  memcpy(level, now, sizeof level);
  put(level, GRAVITY, FBL_CENTER, FBL_CENTER, FBL_GRAVITY);
  put(level, ROTORS, FBL_ON_BOOM, FBL_GIVEN, FBL_ON_HUB);
  put(level, CALLBACK, ROWS, ROWS, FORCES);
  if (level[BODY] != LARGE) {
    return FBL_NONE;
  }
  FBL_TRY(near_by(level));
  FBL_TRY(walk(h));
  for (int s = 0; s < n_body; s++) {
    static fb_state state_alone;
    static fb_input in;
    const int k = body_of[s];
    const fb_motion *const motion = &path[2].motion.motion[s];
    const double f_size = (double)fbl_unit(1.0, 1, 1, -2), t_size = (double)fbl_unit(1.0, 1, 2, -2);
    int n = 0, same = 0;
    if (body(k)->lines.n_line == 0 || (kind[k] == FB_JOINT_FREE && now[ROOT] == ROOT_DRIVEN)) {
      continue;
    }
    FBL_TRY(alone(&state_alone, &in, &path[2], &input, k));
    in.t = input.t;
    in.distributed = input.distributed;
    in.user = input.user;
    if (!loads_of(&in, s)) {
      continue;
    }
    FBL_TRY(fb_system_lines_eval(&mechanism, model, in_system, &n, &path[2].motion, &input, s));
    FBL_TRY(fb_body_lines_eval(body(k), own, &same, &state_alone, motion, &in));
    for (int p = 0; p < n; p++) {
      miss = larger(miss, over(own[p].force, in_system[p].force, 3, f_size));
      miss = larger(miss, over(own[p].moment, in_system[p].moment, 3, t_size));
    }
    for (int node = 0; node < body(k)->n_node; node++) {
      fb_node_loads a, b;
      if (body(k)->node[node].line.line == 0) {
        continue;
      }
      FBL_TRY(fb_system_node_loads_eval(&mechanism, model, &a, &path[2].motion, &input, s, node));
      FBL_TRY(fb_body_node_loads_eval(body(k), &b, &state_alone, motion, &in, node));
      miss = larger(miss, over(b.force, a.force, 3, f_size));
      miss = larger(miss, over(b.moment, a.moment, 3, t_size));
    }
    miss = n == same ? miss : 1.0;
  }
  return miss;
}

/* ---- laws: latches */

/* Locking an axis is an impact within the system: what it does not touch keeps its momentum, energy is lost; freed again
   all moves on as before it was freed. */
static double latches(double h)
{
  static look open, shut, freed;
  static fb_system_state at;
  static fb_system_input in;
  int level[FBL_FEATURES], j = -1, axis;
  double miss = 0.0;
  (void)h;
  memcpy(level, now, sizeof level);
  put(level, METHOD, AS_LOOPS, AS_LOOPS, FB_METHOD_RECURSIVE);
  put(level, MODE, FB_AXIS_LOCKED, FB_AXIS_PRESCRIBED, SOME_MODES);
  put(level, LOOP, PLANAR, PLANAR, NO_LOOP);
  put(level, BODY, LINEAR, SPIN, FULL);
  put(level, ROTORS, FBL_GIVEN, FBL_GIVEN, FBL_ON_BOOM);
  FBL_TRY(near_by(level));
  for (int k = n_body - 1; k > 0 && j < 0; k--) {
    j = kind[k] != FB_JOINT_FREE && axes_of(kind[k]) > 0 && state.mode[slot[k]][0] == FB_AXIS_FREE ? slot[k] : -1;
  }
  if (j < 0) {
    return FBL_NONE;
  }
  axis = is_ball(mechanism.joint[j].kind) ? 0 : axes_of(mechanism.joint[j].kind) - 1;
  if (state.mode[j][axis] != FB_AXIS_FREE) {
    axis = 0;
  }
  input_fill(&in, 0.0);
  at = state;
  FBL_TRY(look_at(&open, &at, &in));
  FBL_TRY(fb_system_axis_set(&mechanism, model, &at, &work, j, axis, FB_AXIS_LOCKED, &in));
  FBL_TRY(look_at(&shut, &at, &in));
  FBL_TRY(fb_system_axis_set(&mechanism, model, &at, &work, j, axis, FB_AXIS_FREE, &in));
  FBL_TRY(look_at(&freed, &at, &in));
  miss = fabs((double)shut.motion.joint[j].speed[axis]) /
         (double)fbl_unit(1.0, 0, slides(mechanism.joint[j].kind, axis), -1);
  for (int k = 0; k < n_body; k++) {
    for (int n = 0; n < body(k)->n_node; n++) {
      const fb_node_motion *const p = &shut.node[k][n], *const q = &freed.node[k][n];
      miss = larger(miss, over(p->velocity, q->velocity, 3, (double)fbl_unit(size, 0, 1, -1)));
      miss = larger(miss, over(p->angular_rate, q->angular_rate, 3, (double)fbl_unit(1.0, 0, 0, -1)));
      miss = larger(miss, over(open.node[k][n].position, p->position, 3, (double)fbl_unit(size, 0, 1, 0)));
    }
  }
  if (now[ROOT] == ROOT_FREE && desc.n_loop == 0 && now[CALLBACK] != ROWS) { /* nothing holds it to the ground */
    miss = larger(miss, over(open.momentum.linear, shut.momentum.linear, 3, (double)fbl_unit(1.0, 1, 1, -1)));
    miss = larger(miss, over(open.momentum.angular, shut.momentum.angular, 3, (double)fbl_unit(1.0, 1, 2, -1)));
  }
  if (now[ROOT] != ROOT_DRIVEN && now[MODE] == FB_AXIS_FREE) { /* nor works on it */
    const double more = (double)shut.energy.kinetic - (double)open.energy.kinetic;
    miss = larger(miss, more / ((double)open.energy.kinetic + (double)fbl_unit(1e-3, 1, 2, -2)));
  }
  return miss;
}

/* ---- laws: the same scene seen otherwise */

enum { STEPS = 12 };

/* Runs some steps of the drawn scene and looks at its end. step: in units of the model. */
static fb_status motion_of(look *end, double step, int n)
{
  static fb_system_state at;
  static fb_system_input in;
  fb_status status = FB_OK;
  at = state;
  for (int k = 0; k < n && status == FB_OK; k++) {
    status = rk4(&at, k * step, step);
  }
  input_fill(&in, n * step / (double)fbl_unit(1.0, 0, 0, 1));
  return status ? status : look_at(end, &at, &in);
}

static double boosted_for; /* [s] since the start of b, of a scene that flies along */

/* Largest difference of two looks over the size of what is compared, by bodies of the scene. a is one of the plain scene,
   b as fbl_seen has it; joints_of_a: where a has the tree's joints; forces: of joints,
   too, 2: and limits of steps, which a power method finds to 5 % (E11.40). */
static double looks_differ(const look *a, const look *b, const int *joints_of_a, int with_forces)
{
  double miss = 0.0;
  const double length = (double)fbl_unit(size, 0, 1, 0), speed = (double)fbl_unit(size, 0, 1, -1);
  for (int k = 0; k < n_body; k++) {
    for (int n = 0; n < body(k)->n_node; n++) {
      const fb_node_motion *const p = &a->node[k][n], *const q = &b->node[k][n];
      fb_real x[3], v[3], acc[3], w[3], alpha[3], boost[3];
      fbl_inertial_polar(boost, fbl_seen.boost[0], fbl_seen.boost[1], fbl_seen.boost[2], 0, 1, -1);
      fbl_inertial_polar(x, (double)p->position[0], (double)p->position[1], (double)p->position[2], 0, 1, 0);
      fbl_inertial_polar(v, (double)p->velocity[0], (double)p->velocity[1], (double)p->velocity[2], 0, 1, -1);
      fbl_inertial_polar(acc, (double)p->acceleration[0], (double)p->acceleration[1], (double)p->acceleration[2], 0, 1,
                         -2);
      fbl_inertial_axial(w, (double)p->angular_rate[0], (double)p->angular_rate[1], (double)p->angular_rate[2], 0, 0,
                         -1);
      fbl_inertial_axial(alpha, (double)p->angular_acceleration[0], (double)p->angular_acceleration[1],
                         (double)p->angular_acceleration[2], 0, 0, -2);
      for (int i = 0; i < 3; i++) {
        x[i] += fbl_unit(fbl_seen.shift[i], 0, 1, 0) + (fb_real)(boosted_for * (double)boost[i]);
        v[i] += boost[i];
      }
      miss = larger(miss, over(x, q->position, 3, length));
      miss = larger(miss, over(v, q->velocity, 3, speed));
      miss = larger(miss, over(acc, q->acceleration, 3, (double)fbl_unit(size, 0, 1, -2)));
      miss = larger(miss, over(w, q->angular_rate, 3, (double)fbl_unit(1.0, 0, 0, -1)));
      miss = larger(miss, over(alpha, q->angular_acceleration, 3, (double)fbl_unit(1.0, 0, 0, -2)));
    }
    if (with_forces == 2 && k == 0 && desc.n_loop == 0) { /* of loops where joint coordinates are zero */
      const fb_real limit[2] = {a->limit.rk4, a->limit.sdirk}, seen[2] = {b->limit.rk4, b->limit.sdirk};
      for (int i = 0; i < 2; i++) {
        const double rate = 1.0 / (double)fbl_unit((double)limit[i], 0, 0, 1), own = 1.0 / (double)seen[i];
        miss = larger(miss, 2e-7 * fabs(own - rate) / (rate + (double)fbl_unit(1e-6, 0, 0, -1)));
      }
    }
    if (with_forces) {
      const fb_joint_motion *const p = &a->motion.joint[joints_of_a[k]], *const q = &b->motion.joint[joint_slot[k]];
      fb_real f[3], t[3];
      fbl_inertial_polar(f, (double)p->force[0], (double)p->force[1], (double)p->force[2], 1, 1, -2);
      fbl_inertial_axial(t, (double)p->torque[0], (double)p->torque[1], (double)p->torque[2], 1, 2, -2);
      miss = larger(miss, over(f, q->force, 3, (double)fbl_unit(10.0, 1, 1, -2)));
      miss = larger(miss, over(t, q->torque, 3, (double)fbl_unit(10.0, 1, 2, -2)));
    }
  }
  return miss;
}

/* The scene as it is, then as `view` has it. */
static double seen_as(const fbl_view *view)
{
  static look first, second;
  int joints_of_first[BODIES_MOST], level[FBL_FEATURES];
  double step, miss;
  fb_status status;
  memcpy(level, now, sizeof level);
  fbl_plain();
  fbl_seen.undeformed = view->undeformed;
  FBL_TRY(draw(level));
  memcpy(joints_of_first, joint_slot, sizeof joints_of_first);
  step = 0.1 * step_of(&status, 0);
  FBL_TRY(status);
  FBL_TRY(motion_of(&first, step, STEPS));
  fbl_seen = *view;
  FBL_TRY(draw(level));
  FBL_TRY(motion_of(&second, step * view->s, STEPS));
  boosted_for = STEPS * step;
  /* loops of joints with one direction may hold twice what holds: forces that are not unique */
  miss = looks_differ(&first, &second, joints_of_first, now[LOOP] != NO_LOOP && now[FRAME] == PLAIN ? 0 : 2);
  boosted_for = 0.0;
  fbl_plain();
  return miss;
}

/* Springs of a free joint have axes of the ground, which do not turn. */
static const fbl_view *turned(void)
{
  static const fbl_view shifted = {1.0, 1.0, 1.0, 0, 0, 0, {1.0, 0.0, 0.0, 0.0}, {3.0, -2.0, 5.0}, {0.0, 0.0, 0.0}};
  return now[SPRING] == MOORED ? &shifted : &fbl_turned;
}

static double turned_and_shifted(double h)
{
  (void)h;
  return seen_as(turned());
}

static double other_units(double h)
{
  (void)h;
  return seen_as(&fbl_other_units);
}

static double mirrored(double h)
{
  (void)h;
  return now[ROTORS] == FBL_UNBALANCED ? FBL_NONE : seen_as(&fbl_mirrored);
}

static double reordered(double h)
{
  (void)h;
  return n_body > 1 || input.n_load > 1 ? seen_as(&fbl_reordered) : FBL_NONE;
}

static double boosted(double h)
{
  static const fbl_view view = {1.0, 1.0, 1.0, 0, 0, 0, {1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {200.0, -300.0, 100.0}};
  int level[FBL_FEATURES];
  (void)h;
  memcpy(level, now, sizeof level); /* the ground, a center, the air stay behind; see is_crude */
  put(level, ROOT, 0, ROOT_DRIVEN, ROOT_FREE);
  put(level, BODY, LINEAR, SPIN, FULL);
  put(level, GRAVITY, FBL_CENTER, FBL_CENTER, FBL_GRAVITY);
  put(level, CALLBACK, 0, ROWS, NO_CALLBACK);
  put(level, SPRING, 0, MOORED, level[BODIES] > 0 ? BETWEEN : NO_SPRING);
  FBL_TRY(near_by(level));
  return seen_as(&view);
}

/* ---- laws: one way against another, where the motion starts */

/* The motion starts anew where a look of the present system is. */
static void start_from(const look *at)
{
  for (int s = 0; s < n_body; s++) {
    fb_link_motion *const m = &start[s];
    const fb_motion *const own = &at->motion.motion[s];
    const int n = mechanism.joint[s].kind == FB_JOINT_FREE, k = body_of[s];
    memcpy(m->value, n ? at->motion.pose[s].rho : at->motion.joint[s].value, sizeof m->value);
    memcpy(m->quat, at->motion.pose[s].quat, sizeof m->quat);
    if (mechanism.joint[s].kind == FB_JOINT_SPHERICAL) {
      fb_quat_from_rotvec(m->quat, at->motion.joint[s].value);
      memset(m->value, 0, sizeof m->value);
    }
    memcpy(m->speed, at->motion.joint[s].speed, sizeof m->speed);
    if (n) {
      memcpy(m->speed, own->v, 3 * sizeof m->speed[0]);
      memcpy(m->speed + 3, own->w, 3 * sizeof m->speed[0]);
    }
    memcpy(m->q, at->motion.pose[s].q, (size_t)body(k)->n * sizeof m->q[0]);
    memcpy(m->q_dot, own->q_dot, (size_t)body(k)->n * sizeof m->q_dot[0]);
    memcpy(m->rotor_speed, own->rotor_speed, sizeof m->rotor_speed);
  }
}

static double start_differs(const look *first)
{
  static look second;
  static fb_system_input in;
  input_fill(&in, 0.0);
  FBL_TRY(look_at(&second, &state, &in));
  return looks_differ(first, &second, slot,
                      now[LOOP] == NO_LOOP); /* of the tree; forces in redundant loops are not unique */
}

static double other_methods(double h)
{
  static look first;
  static fb_system_input in;
  double miss = 0.0;
  int level[FBL_FEATURES];
  (void)h;
  memcpy(level, now, sizeof level);
  put(level, METHOD, AS_LOOPS, AS_LOOPS, FB_METHOD_RECURSIVE);
  FBL_TRY(near_by(level));
  input_fill(&in, 0.0);
  FBL_TRY(look_at(&first, &state, &in));
  start_from(&first);
  for (int m = 0; m <= (may_be_loops(now) ? AS_LOOPS : FB_METHOD_DENSE); m++) {
    double own;
    if (m == now[METHOD] || (m == FB_METHOD_DENSE && now[BODIES] > 2 && now[MADE] >= IMPORTED)) {
      continue;
    }
    desc.method = m == FB_METHOD_DENSE ? FB_METHOD_DENSE : FB_METHOD_RECURSIVE;
    FBL_TRY(system_make());
    FBL_TRY(state_draw(&in));
    if (m == AS_LOOPS) {
      FBL_TRY(joints_to_loops());
    }
    own = start_differs(&first);
    if (own < 0.0) {
      return own;
    }
    miss = larger(miss, own);
  }
  return miss;
}

/* Asked for a posture in which its loops are open, a system closes them as much apart, whatever the method is, and
   moves on a little where a little else is asked for: at most 1e5 times as far. */
static double open_loops(double h)
{
  static look first, second;
  static fb_system_input in;
  double miss = 0.0;
  (void)h;
  if (now[LOOP] == NO_LOOP || now[METHOD] == AS_LOOPS || now[CALLBACK] == ROWS) {
    return FBL_NONE; /* of the caller's rows that turn the way to the closed posture is no straight one */
  }
  input_fill(&in, 0.0);
  for (int run = 0; run < 3; run++) {
    fb_status status;
    for (int k = 0; k < n_body; k++) {
      fb_link_motion *const m = &start[k];
      for (int i = 0; i < 3 && run != 1; i++) {
        m->value[i] *= run ? FB_R(1.0) + FB_R(1e-6) : FB_R(1.1);
      }
    }
    desc.method = run == 1 && desc.method == FB_METHOD_RECURSIVE ? FB_METHOD_DENSE : FB_METHOD_RECURSIVE;
    FBL_TRY(system_make());
    status = state_draw(&in);
    if (run == 0 && status == FB_ERR_CONTRADICTION) { /* it cannot be closed */
      return FBL_NONE;
    }
    FBL_TRY(status);
    FBL_TRY(look_at(run ? &second : &first, &state, &in));
    if (run) {
      const double own = looks_differ(&first, &second, slot, 0);
      miss = larger(miss, run == 1 ? own : 1e-6 * own);
    }
  }
  return miss;
}

/* A joint of the tree that is closed as a loop, its body free, acts the same. */
static double closed_joints(double h)
{
  static look first;
  static fb_system_input in;
  const int k = n_body - 1, s = slot[n_body - 1];
  fb_joint_desc *const d = &desc.joint[s], *const loop = &desc.loop[desc.n_loop];
  fb_link_motion *const m = &start[s];
  (void)h;
  if (k == 0 || kind[k] == FB_JOINT_FREE || now[METHOD] == AS_LOOPS || desc.n_loop > 1) {
    return FBL_NONE;
  }
  input_fill(&in, 0.0);
  FBL_TRY(look_at(&first, &state, &in));
  start_from(&first);
  *loop = *d;
  loop->child = s;
  loop->child_node = 0;
  in.drive[n_body + desc.n_loop] = in.drive[s];
  desc.n_loop++;
  memset(&in.drive[s], 0, sizeof in.drive[s]);
  memset(d, 0, sizeof *d);
  d->parent = FB_GROUND;
  memcpy(m->value, first.motion.pose[s].rho, sizeof m->value);
  memcpy(m->quat, first.motion.pose[s].quat, sizeof m->quat);
  memcpy(m->speed, first.motion.motion[s].v, 3 * sizeof m->speed[0]);
  memcpy(m->speed + 3, first.motion.motion[s].w, 3 * sizeof m->speed[0]);
  FBL_TRY(system_make());
  FBL_TRY(state_draw(&in));
  {
    static look second;
    double miss;
    FBL_TRY(look_at(&second, &state, &in));
    second.motion.joint[s] = second.motion.joint[n_body + desc.n_loop - 1];
    miss = looks_differ(&first, &second, slot, now[LOOP] == NO_LOOP);
    return miss;
  }
}

/* Quaternion of a rotation: its largest component first. */
static void quat_of(fb_real q[4], const fb_real R[9])
{
  const double a = (double)R[0], b = (double)R[4], c = (double)R[8];
  const double s[4] = {1.0 + a + b + c, 1.0 + a - b - c, 1.0 - a + b - c, 1.0 - a - b + c};
  const double yz = (double)R[5] + (double)R[7], zx = (double)R[2] + (double)R[6], xy = (double)R[1] + (double)R[3];
  const double x = (double)R[7] - (double)R[5], y = (double)R[2] - (double)R[6], z = (double)R[3] - (double)R[1];
  const double column[4][4] = {{s[0], x, y, z}, {x, s[1], xy, zx}, {y, xy, s[2], yz}, {z, zx, yz, s[3]}};
  int most = 0;
  for (int i = 1; i < 4; i++) {
    most = s[i] > s[most] ? i : most;
  }
  for (int i = 0; i < 4; i++) {
    q[i] = (fb_real)(0.5 * column[most][i] / sqrt(s[most]));
  }
}

/* A joint that is locked is a rigid one in its pose. */
static double locked_joints(double h)
{
  static look first, second;
  static fb_system_input in;
  int n = 0;
  double x[3];
  int level[FBL_FEATURES];
  memcpy(level, now, sizeof level);
  put(level, MODE, FB_AXIS_FREE, FB_AXIS_FREE, FB_AXIS_LOCKED);
  put(level, MODE, FB_AXIS_PRESCRIBED, FB_AXIS_PRESCRIBED, SOME_MODES);
  put(level, METHOD, AS_LOOPS, AS_LOOPS, FB_METHOD_RECURSIVE);
  FBL_TRY(near_by(level));
  (void)h;
  input_fill(&in, 0.0);
  FBL_TRY(look_at(&first, &state, &in));
  start_from(&first);
  path[2] = first;
  for (int k = 1; k < n_body; k++) {
    fb_joint_desc *const d = &desc.joint[slot[k]];
    const fb_joint *const joint = &mechanism.joint[slot[k]];
    int locked = kind[k] != FB_JOINT_FREE && kind[k] != FB_JOINT_RIGID;
    fb_real R[9], A[9], C[9], arm[3];
    const fb_node_motion *const node = &first.node[parent[k]][joint->parent_node];
    for (int i = 0; i < axes_of(kind[k]); i++) {
      locked &= state.mode[slot[k]][is_ball(kind[k]) ? 0 : i] == FB_AXIS_LOCKED;
    }
    if (!locked) {
      continue;
    }
    n++;
    joint_frame(x, R, slot[k], 0); /* of the child: both frames coincide there from now on */
    fb_quat_to_mat33(A, node->quat);
    for (int i = 0; i < 3; i++) {
      arm[i] = (fb_real)(x[i] - (double)node->position[i]);
    }
    for (int i = 0; i < 3; i++) {
      d->position[i] = A[i] * arm[0] + A[3 + i] * arm[1] + A[6 + i] * arm[2];
      for (int j = 0; j < 3; j++) {
        C[3 * i + j] = A[i] * R[j] + A[3 + i] * R[3 + j] + A[6 + i] * R[6 + j];
      }
    }
    d->kind = FB_JOINT_RIGID;
    quat_of(d->attitude, C);
    quat_of(d->child_attitude, joint->child_axes);
    memset(d->axis, 0, sizeof d->axis);
    memset(d->child_axis, 0, sizeof d->child_axis);
    memset(d->mode, 0, sizeof d->mode);
    memset(d->stiffness, 0, sizeof d->stiffness);
    memset(d->rest, 0, sizeof d->rest);
    memset(d->damping, 0, sizeof d->damping);
    memset(d->friction, 0, sizeof d->friction);
    memset(d->friction_speed, 0, sizeof d->friction_speed);
    memset(d->stop, 0, sizeof d->stop);
    memset(d->stop_stiffness, 0, sizeof d->stop_stiffness);
    memset(d->stop_loss, 0, sizeof d->stop_loss);
    d->pitch = FB_R(0.0);
    memset(&start[slot[k]].value, 0, sizeof start[0].value);
    memset(&start[slot[k]].quat, 0, sizeof start[0].quat);
    memset(&start[slot[k]].speed, 0, sizeof start[0].speed);
  }
  if (n == 0) {
    return FBL_NONE;
  }
  FBL_TRY(system_make());
  FBL_TRY(state_draw(&in));
  FBL_TRY(look_at(&second, &state, &in));
  return looks_differ(&first, &second, slot, now[LOOP] != PLANAR);
}

/* A free body is a system of its own. */
static double one_body(double h)
{
  static fb_state own;
  static fb_rk4_work own_work;
  static fb_input in[3];
  static fb_system_input all;
  static look first, second;
  double step;
  fb_status status;
  int level[FBL_FEATURES];
  (void)h;
  memcpy(level, now, sizeof level);
  put(level, BODIES, 0, 4, 0);
  put(level, ROOT, 0, ROOT_DRIVEN, ROOT_FREE);
  put(level, BODY, LINEAR, SPIN, FULL);
  put(level, SPRING, 0, MOORED, NO_SPRING);
  put(level, CALLBACK, 0, ROWS, NO_CALLBACK);
  put(level, WHEEL, 0, 1, 0);
  FBL_TRY(near_by(level));
  step = 0.02 * step_of(&status, 0);
  FBL_TRY(status);
  FBL_TRY(motion_of(&first, step, STEPS));
  input_fill(&all, 0.0);
  FBL_TRY(look_at(&second, &state, &all));
  FBL_TRY(alone(&own, &in[0], &second, &all, 0));
  for (int r = 0; r < body(0)->n_rotor; r++) {
    own.q[body(0)->n + r] = state.link[0].q[body(0)->n + r];
  }
  for (int k = 0; k <= STEPS; k++) {
    for (int i = 0; i < 3; i++) {
      input_fill(&all, (k + 0.5 * i) * step / (double)fbl_unit(1.0, 0, 0, 1));
      memset(&in[i], 0, sizeof in[i]);
      memcpy(in[i].rotor, all.rotor[0], sizeof in[i].rotor);
      in[i].n_load = all.n_load;
      for (int n = 0; n < all.n_load; n++) {
        in[i].load[n] = all.load[n].load;
      }
      in[i].distributed = all.distributed;
      in[i].user = all.user;
      in[i].t = all.t;
    }
    if (k < STEPS) {
      FBL_TRY(fb_rk4_step(body(0), &own, &own_work, &in[0], &in[1], &in[2], (fb_real)step));
    }
  }
  memset(&second, 0, sizeof second);
  FBL_TRY(fb_body_motion_eval(body(0), &second.motion.motion[0], &own, &in[0]));
  second.motion.pose[0] = own;
  FBL_TRY(nodes_look(&second));
  return looks_differ(&first, &second, slot, 0);
}

/* ---- laws: steps */

/* As rk4, by sdirk. */
static fb_status sdirk(fb_system_state *at, double t, double step)
{
  static fb_system_input in[2];
  const double unit = (double)fbl_unit(1.0, 0, 0, 1);
  input_fill(&in[0], t / unit);
  input_fill(&in[1], (t + step) / unit);
  return fb_system_sdirk_step(&mechanism, model, at, &work, &in[0], &in[1], (fb_real)step, 4);
}

static fb_status end_of(look *end, int implicit, double time, int n)
{
  static fb_system_state at;
  static fb_system_input in;
  fb_status status = FB_OK;
  at = state;
  for (int k = 0; k < n && status == FB_OK; k++) {
    status = implicit ? sdirk(&at, k * time / n, time / n) : rk4(&at, k * time / n, time / n);
  }
  input_fill(&in, time / (double)fbl_unit(1.0, 0, 0, 1));
  return status ? status : look_at(end, &at, &in);
}

/* By how much halving the step falls short of its order. */
static double order_missed(double coarse, double fine, double factor)
{
  return fine < 1e-10 || factor * fine < coarse ? 0.0 : factor * fine / coarse - 1.0;
}

static double order_of_rk4(double h)
{
  static look end[3];
  fb_status status;
  const double time = 1.6 * step_of(&status, 0);
  const int n = (int)(1.6 / h + 0.5);
  if (now[EFFORT] == STOP) {
    return FBL_NONE; /* kinks */
  }
  FBL_TRY(status);
  for (int k = 0; k < 3; k++) {
    FBL_TRY(end_of(&end[k], 0, time, n << k));
  }
  return order_missed(looks_differ(&end[0], &end[1], slot, 0), looks_differ(&end[1], &end[2], slot, 0), 16.0);
}

static double order_of_sdirk(double h)
{
  static look end[3];
  fb_status status;
  const double time = 1.6 * step_of(&status, 1);
  const int n = (int)(1.6 / h + 0.5);
  if (now[EFFORT] == STOP) {
    return FBL_NONE;
  }
  FBL_TRY(status);
  FBL_TRY(end_of(&end[2], 0, time, 2 * n));
  for (int k = 0; k < 2; k++) {
    FBL_TRY(end_of(&end[k], 1, time, n << k));
  }
  return order_missed(looks_differ(&end[0], &end[2], slot, 0), looks_differ(&end[1], &end[2], slot, 0), 4.0);
}

static int links_differ(const fb_system_state *a, const fb_system_state *b)
{
  int differ = memcmp(&a->motor_work, &b->motor_work, sizeof a->motor_work);
  for (int s = 0; s < n_body; s++) {
    const fb_link_state *const x = &a->link[s], *const y = &b->link[s];
    const size_t n = (size_t)model[mechanism.model[s]].n_coordinate;
    differ |=
        memcmp(x->x, y->x, sizeof x->x) | memcmp(x->quat, y->quat, sizeof x->quat) | memcmp(x->p, y->p, sizeof x->p);
    differ |= memcmp(x->q, y->q, n * sizeof x->q[0]) | memcmp(x->pi, y->pi, n * sizeof x->pi[0]);
    differ |= memcmp(x->u, y->u, sizeof x->u);
  }
  return differ != 0;
}

/* Some steps with work structs full of a byte (-1: as they are), each from a copy of the state before. */
static fb_status dirty_run(fb_system_state *end, look *seen, double step, int byte)
{
  static fb_system_input in;
  fb_status status = FB_OK;
  *end = state;
  for (int k = 0; k < 5 && status == FB_OK; k++) {
    const fb_system_state before = *end;
    *end = before;
    if (byte >= 0) {
      memset(&work, byte, sizeof work);
    }
    status = k == 4 ? FB_OK : k == 3 ? sdirk(end, k * step, step) : rk4(end, k * step, step);
  }
  input_fill(&in, 4 * step / (double)fbl_unit(1.0, 0, 0, 1));
  return status ? status : look_at(seen, end, &in);
}

/* What is in the work before a call changes no bit: neither numbers of the size of the work's own, nor what is none. */
static double dirt(double h)
{
  static const int byte[] = {0xA5, 0x40, 0xFF};
  static fb_system_state end[2];
  static look seen[2];
  fb_status status;
  const double step = 0.1 * step_of(&status, 1);
  (void)h;
  FBL_TRY(status);
  FBL_TRY(dirty_run(&end[0], &seen[0], step, -1));
  for (int k = 0; k < FBL_COUNT(byte); k++) {
    if (dirty_run(&end[1], &seen[1], step, byte[k]) != FB_OK || links_differ(&end[0], &end[1]) ||
        !(looks_differ(&seen[0], &seen[1], joint_slot, 1) <= 0.0)) {
      return 1.0;
    }
  }
  return 0.0;
}

/* An input or a motion of the start that is absent is one that is zero, to the last bit, in status, too. */
static double absent(double h)
{
  static const fb_system_input zero;
  static const fb_link_motion rest[FB_MAX_BODIES];
  static fb_system_motion motion[2];
  static fb_momentum momentum[2];
  static fb_energy energy[2];
  static fb_system_state begun[2], rate[2], at[2];
  fb_status status[2][7];
  const double step = 0.3 * step_of(&status[0][0], 1);
  (void)h;
  FBL_TRY(status[0][0]);
  for (int k = 0; k < 2; k++) {
    const fb_system_input *const in = k ? &zero : NULL;
    memset(&motion[k], 0, sizeof motion[k]);
    memset(&momentum[k], 0, sizeof momentum[k]);
    memset(&energy[k], 0, sizeof energy[k]);
    memset(&rate[k], 0, sizeof rate[k]);
    memset(&begun[k], 0, sizeof begun[k]);
    at[k] = state;
    status[k][0] = fb_system_state_init(&mechanism, model, &begun[k], &work, k ? rest : NULL, in);
    status[k][1] = fb_system_motion_eval(&mechanism, model, &work, &motion[k], &state, in);
    status[k][2] = fb_system_rates_eval(&mechanism, model, &work, &rate[k], &state, in);
    status[k][3] = fb_system_energy_eval(&mechanism, model, &work, &energy[k], &state, in);
    status[k][4] = fb_system_momentum_eval(&mechanism, model, &work, &momentum[k], &state, in);
    status[k][5] = fb_system_rk4_step(&mechanism, model, &at[k], &work, in, in, in, (fb_real)step);
    status[k][6] = fb_system_sdirk_step(&mechanism, model, &at[k], &work, in, in, (fb_real)step, 3);
  }
  return memcmp(status[0], status[1], sizeof status[0]) != 0 || memcmp(&begun[0], &begun[1], sizeof begun[0]) != 0 ||
                 memcmp(&motion[0], &motion[1], sizeof motion[0]) != 0 ||
                 memcmp(&rate[0], &rate[1], sizeof rate[0]) != 0 ||
                 memcmp(&energy[0], &energy[1], sizeof energy[0]) != 0 ||
                 memcmp(&momentum[0], &momentum[1], sizeof momentum[0]) != 0 ||
                 memcmp(&at[0], &at[1], sizeof at[0]) != 0
             ? 1.0
             : 0.0;
}

/* Draws the scene of other levels near rest, where its equations are linear. */
static fb_status draw_quiet(int *level, double size_of_motion)
{
  static fb_system_input in;
  fb_status status;
  put(level, GRAVITY, 0, FBL_CENTER, FBL_NO_GRAVITY);
  put(level, MOTION, 0, FLIGHT, SLOW);
  put(level, EFFORT, STOP, STOP, FRICTION);
  put(level, LOAD, DISTRIBUTED, DISTRIBUTED, FOLLOWER);
  put(level, SPRING, BETWEEN, CORD, NO_SPRING); /* explicit, pulled at the start */
  put(level, LOOP, BALL, PLANAR, NO_LOOP);
  put(level, CALLBACK, FORCES, ROWS, NO_CALLBACK);
  put(level, ROTORS, FBL_RUBBING, FBL_UNBALANCED, FBL_ON_BOOM);
  put(level, METHOD, AS_LOOPS, AS_LOOPS, FB_METHOD_RECURSIVE);
  legal(level);
  amplitude = size_of_motion;
  status = draw_levels(level);
  for (int j = 0; j < n_body && status == FB_OK; j++) {
    if (desc.joint[j].kind != FB_JOINT_FREE) {
      memset(desc.joint[j].rest, 0, sizeof desc.joint[j].rest);
    }
  }
  input_fill(&in, 0.0);
  status = status ? status : system_make();
  return status ? status : state_draw(&in);
}

/* What the iterations leave of a long step falls with the square of the motion if the matrix of sdirk is the derivative of
   the equations. */
static double small_steps(double h)
{
  static look few, many;
  static fb_system_state at;
  static fb_system_input in[2];
  int level[FBL_FEATURES];
  double step;
  fb_status status;
  memcpy(level, now, sizeof level);
  put(level, EFFORT, FRICTION, STOP, SPRUNG);
  FBL_TRY(draw_quiet(level, h));
  input_fill(&in[0], 0.0);
  step = 4.0 * step_of(&status, 0);
  FBL_TRY(status);
  input_fill(&in[1], step / (double)fbl_unit(1.0, 0, 0, 1));
  at = state;
  FBL_TRY(fb_system_sdirk_step(&mechanism, model, &at, &work, &in[0], &in[1], (fb_real)step, 15));
  FBL_TRY(look_at(&many, &at, &in[1]));
  at = state;
  status = fb_system_sdirk_step(&mechanism, model, &at, &work, &in[0], &in[1], (fb_real)step, 2);
  if (status != FB_OK) {
    return 1.0;
  }
  FBL_TRY(look_at(&few, &at, &in[1]));
  return looks_differ(&many, &few, slot, 0) / h;
}

/* One long step of sdirk of a scene as it is seen; *left: what the last iteration changed, of a step that did not
   converge. */
static fb_status step_as_seen(double *left, const fbl_view *view, double step)
{
  double need;
  fb_status status;
  fbl_seen = *view;
  status = fbl_draw_again();
  mechanism.allow_long_step = 1;
  if (status == FB_OK) {
    static fb_system_state at;
    at = state;
    status = sdirk(&at, 0.0, step);
  }
  (void)fbl_record(left, &need, 1.0);
  fbl_plain();
  return status;
}

/* What tells that a step has not converged does not depend on the attitude, but for the rounding that grows where iterations
   diverge. */
static double convergence(double h)
{
  const fbl_view plain = fbl_seen;
  fb_status status;
  const double step = step_of(&status, 1);
  (void)h;
  FBL_TRY(status);
  for (int twice = 0; twice < 9; twice++) {
    double left[3];
    status = step_as_seen(&left[0], &plain, step * (1 << twice));
    if (status == FB_ERR_CONVERGENCE) { /* of iterations that rounding decides, as between stops, it says nothing */
      (void)step_as_seen(&left[2], &plain, step * (1 << twice) * (1.0 + 1e-13));
      if (fabs(left[2] - left[0]) > 1e-4 * left[0]) {
        return FBL_NONE;
      }
      return step_as_seen(&left[1], turned(), step * (1 << twice)) == status
                 ? fabs(left[1] - left[0]) / (left[0] + 1e-300)
                 : 1.0;
    }
  }
  return FBL_NONE;
}

static void rotors_speed_up(double factor)
{
  for (int k = 0; k < n_body; k++) {
    for (int r = 0; r < FB_MAX_ROTORS; r++) {
      start[k].rotor_speed[r] *= (fb_real)factor;
    }
  }
}

/* A step that is longer than its limit is refused and leaves the state; one that is shorter is not refused for that.
   Faster rotors allow no longer steps. */
static double limits(double h)
{
  static fb_system_state at;
  fb_system_limit limit;
  static fb_system_input in;
  fb_system_limit faster;
  fb_status status;
  (void)h;
  input_fill(&in, 0.0);
  FBL_TRY(fb_system_limit_eval(&mechanism, model, &work, &limit, &state, &in));
  rotors_speed_up(10.0);
  status = fb_system_state_init(&mechanism, model, &at, &work, start, &in);
  rotors_speed_up(0.1);
  FBL_TRY(status);
  FBL_TRY(fb_system_limit_eval(&mechanism, model, &work, &faster, &at, &in));
  if ((double)faster.rk4 > 1.0001 * (double)limit.rk4 || (double)faster.sdirk > 1.0001 * (double)limit.sdirk) {
    printf("L %g %g  %g %g\n", (double)limit.rk4, (double)faster.rk4, (double)limit.sdirk, (double)faster.sdirk);
    return 1.0;
  }
  for (int k = 0; k < 2; k++) {
    const double most = (double)(k ? limit.sdirk : limit.rk4);
    char what[160];
    double have = 1.001, need = 1.0;
    if (most > 1e6 * (double)fbl_unit(1.0, 0, 0, 1)) {
      continue;
    }
    at = state;
    status = k ? sdirk(&at, 0.0, 1.001 * most) : rk4(&at, 0.0, 1.001 * most);
    if (status == FB_ERR_CONTRADICTION && now[MODE]) { /* it does not resolve what is prescribed */
      continue;
    }
    if (status != FB_ERR_STEP || links_differ(&at, &state)) {
      return 1.0;
    }
    (void)snprintf(what, sizeof what, "%s", fbl_record(&have, &need, most));
    if (fabs(have - 1.001) > 1e-6 || fabs(need - 1.0) > 1e-6 ||
        ((k ? sdirk(&at, 0.0, 0.999 * most) : rk4(&at, 0.0, 0.999 * most)) == FB_ERR_STEP &&
         strcmp(what, fbl_record(&have, &need, most)) == 0)) {
      return 1.0;
    }
  }
  return 0.0;
}

/* By how much steps of rk4 enlarge the motion near rest: speeds of the nodes, energy. HUGE_VAL: they were refused. */
static double growth(double step)
{
  static const fb_system_input none;
  static fb_system_state at;
  static look end[2];
  double most[2] = {0.0, 0.0}, mass = 0.0;
  fb_status status = look_at(&end[0], &state, &none);
  at = state;
  for (int k = 0; k < 80 && status == FB_OK; k++) {
    status = fb_system_rk4_step(&mechanism, model, &at, &work, &none, &none, &none, (fb_real)step);
  }
  status = status ? status : look_at(&end[1], &at, &none);
  for (int k = 0; k < n_body && status == FB_OK; k++) {
    mass += (double)body(k)->mass;
    for (int i = 0; i < 2 * body(k)->n_node; i++) {
      most[i % 2] = larger(most[i % 2], fbl_largest(end[i % 2].node[k][i / 2].velocity, 3));
    }
  }
  most[0] += sqrt((double)end[0].energy.strain / mass); /* what springs make of it */
  return status ? HUGE_VAL
                : larger(most[1] / most[0], ((double)end[1].energy.kinetic + (double)end[1].energy.strain) /
                                                ((double)end[0].energy.kinetic + (double)end[0].energy.strain));
}

/* Near rest steps of rk4 at the limit are stable, also under wheels that are fast, whose part of the limit is a bound; those
   a fifth longer are not, of damped modes and joints 2.6 times as long. */
static double limits_hold(double h)
{
  int level[FBL_FEATURES];
  double step;
  fb_status status;
  memcpy(level, now, sizeof level);
  level[LOAD] = level[WHEEL] = level[MODE] = 0;
  put(level, ROOT, ROOT_DRIVEN, ROOT_DRIVEN, ROOT_FREE);
  put(level, EFFORT, MOTOR, MOTOR, SPRUNG);
  if (level[ROTORS]) {
    wheels = (fbl_pick(2) ? 100.0 : 1.0) / h;
    status = draw_quiet(level, h);
    wheels = 1.0;
    FBL_TRY(status);
    step = step_of(&status, 0);
    FBL_TRY(status);
    if (growth(0.99 * step) > 100.0) {
      return 1.0;
    }
  }
  level[ROTORS] = FBL_NO_ROTOR;
  FBL_TRY(draw_quiet(level, h));
  step = step_of(&status, 0);
  FBL_TRY(status);
  if (growth(0.99 * step) > 100.0) {
    return 1.0;
  }
  mechanism.allow_long_step = 1;
  step *= now[DAMPING] || now[EFFORT] || now[SPRING] == MOORED ? 2.6 : 1.2; /* critical damping: 2.41 */
  return step < 0.1 * (double)fbl_unit(1.0, 0, 0, 1) && growth(step) < 1e3 ? 1.0 : 0.0;
}

/* What is no number in a model is refused by its check, or by the evaluation, or nothing reads it; a bit that the check
   word does not see is one that changes nothing. */
static double words(double h)
{
  static fb_system other, own;
  static look first, second;
  static fb_system_input in;
  const unsigned word = fb_system_crc(&mechanism, model, n_model);
  (void)h;
  input_fill(&in, 0.0);
  if (fb_system_check(&mechanism, model, n_model) != FB_OK ||
      fb_system_state_check(&mechanism, model, &state) != FB_OK) {
    return 1.0;
  }
  FBL_TRY(look_at(&first, &state, &in));
  fbl_stream("words");
  own = mechanism;
  for (int k = 0; k < 160; k++) {
    fb_status status;
    unsigned changed;
    memcpy(&other, &own, sizeof other);
    (k < 60 ? fbl_spoil : fbl_flip)(&other, sizeof other);
    changed = fb_system_crc(&other, model, n_model);
    if (fb_system_check(&other, model, n_model) != FB_OK || (k >= 60 && changed != word)) {
      continue;
    }
    mechanism = other;
    status = look_at(&second, &state, &in);
    mechanism = own;
    if (status ? changed == word : looks_differ(&first, &second, joint_slot, 1) > 0.0) {
      return 1.0;
    }
  }
  return 0.0;
}

/* ---- laws: what is wrong */

static int wrong_descriptions(void)
{
  static fb_system out;
  fb_joint_desc *const joint = &desc.joint[n_body - 1], *const loop = &desc.loop[0];
  fb_spring *const spring = &desc.spring[0];
  const int moves = axes_of(joint->kind) > 0 && joint->kind != FB_JOINT_FREE;
  int n = fb_system_init(&out, &work, model, &desc, n_model) != FB_OK;
#define MADE(what, wrong, status) \
  FBL_WRONG(n, what, wrong, status, fb_system_init(&out, &work, model, &desc, n_model), out)
  MADE(desc.n_body, 0, FB_ERR_CAPACITY);
  MADE(desc.n_body, FB_MAX_BODIES + 1, FB_ERR_CAPACITY);
  MADE(desc.n_loop, FB_MAX_LOOPS + 1, FB_ERR_CAPACITY);
  MADE(desc.n_loop, -1, FB_ERR_CAPACITY);
  MADE(desc.n_spring, FB_MAX_SPRINGS + 1, FB_ERR_CAPACITY);
  MADE(desc.method, FB_METHOD_COUNT, FB_ERR_VALUE);
  MADE(desc.model[n_body - 1], n_model, FB_ERR_CAPACITY);
  MADE(desc.model[n_body - 1], -1, FB_ERR_CAPACITY);
  MADE(joint->kind, FB_JOINT_COUNT, FB_ERR_VALUE);
  MADE(joint->mode[0], FB_AXIS_COUNT, FB_ERR_VALUE);
  if (joint->kind != FB_JOINT_FREE) {
    const int ground = joint->parent == FB_GROUND;
    MADE(joint->parent, n_body - 1, FB_ERR_VALUE);
    MADE(joint->parent, FB_GROUND - 1, FB_ERR_VALUE);
    MADE(joint->position[1], FBL_NAN, FB_ERR_NOT_FINITE);
    MADE(joint->child_position[2], FBL_NAN, FB_ERR_NOT_FINITE);
    MADE(joint->attitude[2], FBL_NAN, FB_ERR_NOT_FINITE);
    MADE(joint->parent_node, ground ? 1 : model_at(joint->parent)->n_node, FB_ERR_CAPACITY);
    MADE(joint->parent_node, -1, FB_ERR_CAPACITY);
  }
  if (moves) {
    MADE(joint->stiffness[0], FB_R(-1.0), FB_ERR_VALUE);
    MADE(joint->damping[0], FB_R(-1.0), FB_ERR_VALUE);
    MADE(joint->rest[0], FBL_NAN, FB_ERR_NOT_FINITE);
  }
  if (joint->kind == FB_JOINT_REVOLUTE || joint->kind == FB_JOINT_PRISMATIC || joint->kind == FB_JOINT_SCREW) {
    MADE(joint->friction[0], FB_R(-1.0), FB_ERR_VALUE);
    MADE(joint->stop_stiffness[0], FB_R(-1.0), FB_ERR_VALUE);
    MADE(joint->stop_loss[0], FB_R(-1.0), FB_ERR_VALUE);
    if (!(joint->friction_speed[0] > FB_R(0.0))) {
      MADE(joint->friction[0], FB_R(1.0), FB_ERR_VALUE);
    }
    if (joint->stop_stiffness[0] > FB_R(0.0)) {
      MADE(joint->stop[0][0], joint->stop[0][1] + FB_R(1.0), FB_ERR_VALUE);
    }
  }
  if (desc.n_loop > 0) {
    MADE(loop->kind, FB_JOINT_FREE, FB_ERR_VALUE);
    MADE(loop->child, n_body, FB_ERR_CAPACITY);
    MADE(loop->child_node, model_at(loop->child)->n_node, FB_ERR_CAPACITY);
    MADE(loop->parent, loop->child, FB_ERR_VALUE);
    MADE(loop->position[0], FBL_NAN, FB_ERR_NOT_FINITE);
    MADE(desc.n_loop, 0, FB_ERR_VALUE);
  }
  if (desc.n_spring > 0) {
    const int end = spring->body[1] == FB_GROUND ? 0 : 1;
    MADE(spring->body[end], n_body, FB_ERR_CAPACITY);
    MADE(spring->node[end], model_at(spring->body[end])->n_node, FB_ERR_CAPACITY);
    MADE(spring->stiffness, FB_R(-1.0), FB_ERR_VALUE);
    MADE(spring->length, FB_R(-1.0), FB_ERR_VALUE);
    MADE(spring->damping, FB_R(-1.0), FB_ERR_VALUE);
    MADE(spring->position[0][1], FBL_NAN, FB_ERR_NOT_FINITE);
    MADE(desc.n_spring, 0, FB_ERR_VALUE);
    if (spring->body[0] == FB_GROUND && spring->node[1] == 0) {
      MADE(spring->body[1], FB_GROUND, FB_ERR_VALUE);
    }
  }
#undef MADE
  return n;
}

static int wrong_motions(void)
{
  static fb_system_input in;
  static fb_system_state at, rate;
  static fb_system_motion motion;
  const int s = slot[0];
  fb_link_state *const root = &at.link[s];
  fb_real step = FB_R(1e-6);
  int many = 2, n = 0, number = n_body + desc.n_loop;
  at = rate = state;
  memset(&in, 0, sizeof in);
  input_fill(&in, 0.0);
#define STATE(what, wrong, status) \
  FBL_WRONG(n, what, wrong, status, fb_system_state_check(&mechanism, model, &at), at.motor_work)
  STATE(at.motor_work, FBL_NAN, FB_ERR_NOT_FINITE);
  STATE(at.mode[s][0], FB_AXIS_COUNT, FB_ERR_VALUE);
  if (kind[0] == FB_JOINT_FREE || kind[0] == FB_JOINT_SPHERICAL) {
    STATE(root->quat[0], FB_R(1.5), FB_ERR_VALUE);
    STATE(root->quat[1], FBL_NAN, FB_ERR_NOT_FINITE);
    STATE(root->p[kind[0] == FB_JOINT_FREE ? 5 : 2], FBL_NAN, FB_ERR_NOT_FINITE);
  }
  if (kind[0] == FB_JOINT_REVOLUTE || kind[0] == FB_JOINT_FREE) {
    STATE(root->x[0], FBL_NAN, FB_ERR_NOT_FINITE);
  }
  if (body(0)->n > 0) {
    STATE(root->q[0], FBL_NAN, FB_ERR_NOT_FINITE);
    STATE(root->pi[body(0)->n - 1], FBL_NAN, FB_ERR_NOT_FINITE);
  }
#undef STATE
#define INPUT(what, wrong, status)                                                                                 \
  do {                                                                                                             \
    FBL_WRONG(n, what, wrong, status, fb_system_motion_eval(&mechanism, model, &work, &motion, &at, &in), motion); \
    FBL_WRONG(n, what, wrong, status, fb_system_rates_eval(&mechanism, model, &work, &rate, &at, &in), rate);      \
    FBL_WRONG(n, what, wrong, status, fb_system_rk4_step(&mechanism, model, &at, &work, &in, &in, &in, step), at); \
  } while (0)
  INPUT(in.n_load, FB_MAX_LOADS + 1, FB_ERR_CAPACITY);
  INPUT(in.n_load, -1, FB_ERR_CAPACITY);
  if (in.n_load > 0) {
    fb_system_load *const load = &in.load[in.n_load - 1];
    INPUT(load->body, n_body, FB_ERR_CAPACITY);
    INPUT(load->body, -1, FB_ERR_CAPACITY);
    INPUT(load->load.node, model_at(load->body)->n_node, FB_ERR_CAPACITY);
    INPUT(load->load.axes, FB_AXES_COUNT, FB_ERR_VALUE);
    if (now[CALLBACK] != FORCES) { /* which writes them */
      INPUT(load->load.force[1], FBL_NAN, FB_ERR_NOT_FINITE);
      INPUT(load->load.torque[0], FBL_NAN, FB_ERR_NOT_FINITE);
    }
  }
  for (int r = 0; r < FB_MAX_ROTORS; r++) {
    const int there = r < body(0)->n_rotor, given = there && body(0)->rotor[r].given;
    INPUT(in.rotor[s][r].torque, FBL_NAN, there ? FB_ERR_NOT_FINITE : FB_ERR_VALUE);
    INPUT(in.rotor[s][r].momentum, given ? FBL_NAN : FB_R(1.0), given ? FB_ERR_NOT_FINITE : FB_ERR_VALUE);
  }
  for (int j = 0; j < n_body; j++) {
    if (kind[body_of[j]] == FB_JOINT_FREE && state.mode[j][0] == FB_AXIS_FREE && n_as_loops == 0) {
      INPUT(in.drive[j].torque[0], FB_R(1.0), FB_ERR_VALUE);
    }
  }
  if (now[BODY] != LARGE) {
    INPUT(in.distributed, fbl_wind, FB_ERR_UNSUPPORTED);
  }
#undef INPUT
#define STEP(what, wrong) \
  FBL_WRONG(n, what, wrong, FB_ERR_VALUE, fb_system_sdirk_step(&mechanism, model, &at, &work, &in, &in, step, many), at)
  STEP(step, FB_R(0.0));
  STEP(step, FB_R(-1e-6));
  STEP(step, FBL_NAN);
  STEP(many, -1);
#undef STEP
  FBL_WRONG(n, step, FB_R(0.0), FB_ERR_VALUE, fb_system_rk4_step(&mechanism, model, &at, &work, &in, &in, &in, step),
            at);
  FBL_WRONG(n, number, number, FB_ERR_CAPACITY,
            fb_system_axis_set(&mechanism, model, &at, &work, number, 0, FB_AXIS_LOCKED, &in), at);
  FBL_WRONG(n, number, 0, FB_ERR_CAPACITY,
            fb_system_axis_set(&mechanism, model, &at, &work, number, 6, FB_AXIS_LOCKED, &in), at);
  return n;
}

/* A system in memory that has changed is no legal one any more. */
static int wrong_memory(void)
{
  static fb_system other;
  fb_joint *const joint = &other.joint[n_body - 1];
  int n = 0;
  other = mechanism;
#define MEMORY(what, wrong) \
  FBL_WRONG(n, what, wrong, FB_ERR_CAPACITY, fb_system_check(&other, model, n_model), mechanism)
  MEMORY(other.n_body, FB_MAX_BODIES + 1);
  MEMORY(other.n_loop, FB_MAX_LOOPS + 1);
  MEMORY(other.n_spring, -1);
  MEMORY(other.tied, 3);
  MEMORY(other.model[0], n_model);
  MEMORY(joint->kind, FB_JOINT_COUNT);
  MEMORY(joint->parent, n_body - 1);
  MEMORY(joint->child, n_body - 2);
  MEMORY(joint->child_node, model_at(n_body - 1)->n_node);
  MEMORY(joint->parent_node, joint->parent < 0 ? 1 : model_at(joint->parent)->n_node);
  MEMORY(joint->n_axis, joint->n_axis + 1);
  MEMORY(joint->about, 7);
  MEMORY(joint->mode[2], FB_AXIS_COUNT);
  MEMORY(joint->stiffness[2], FB_R(-1.0));
  MEMORY(joint->damping[1], FB_R(-1.0));
  MEMORY(joint->friction[0], FB_R(-1.0));
  MEMORY(joint->stop_stiffness[0], FB_R(-1.0));
  MEMORY(joint->stop_loss[0], FB_R(-1.0));
  if (other.n_loop > 0) {
    fb_joint *const loop = &other.joint[n_body];
    MEMORY(loop->child, n_body);
    MEMORY(loop->child_node, model_at(loop->child)->n_node);
    MEMORY(loop->parent, n_body);
  }
  if (other.n_spring > 0) {
    fb_spring *const spring = &other.spring[0];
    const int end = spring->body[1] == FB_GROUND ? 0 : 1;
    MEMORY(spring->body[end], n_body);
    MEMORY(spring->node[end], model_at(spring->body[end])->n_node);
    MEMORY(spring->stiffness, FB_R(-1.0));
  }
#undef MEMORY
  return n;
}

/* One wrong value in a legal scene is refused with the status of its kind, and changes nothing. */
static double wrong(double h)
{
  static fb_system_motion motion;
  static fb_system_input in;
  (void)h;
  input_fill(&in, 0.0);
  FBL_TRY(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &in));
  return wrong_descriptions() + wrong_motions() + wrong_memory();
}

/* ---- laws: steady states */

static fb_system_analyse_work analyse;
static fb_system_input steady;

static fb_status step_steady(fb_system_state *at, double step)
{
  return fb_system_rk4_step(&mechanism, model, at, &work, &steady, &steady, &steady, (fb_real)step);
}

/* Trims the scene under constant inputs; 0: it says nothing. */
static int trim(fb_status *status)
{
  int spins, level[FBL_FEATURES];
  memcpy(level, now, sizeof level);
  put(level, METHOD, AS_LOOPS, AS_LOOPS, FB_METHOD_RECURSIVE);
  put(level, CALLBACK, 0, ROWS, NO_CALLBACK);
  put(level, GRAVITY, FBL_CENTER, FBL_CENTER, FBL_GRAVITY);
  put(level, WHEEL, 0, 1, 0);
  put(level, EFFORT, NO_EFFORT, STOP, SPRUNG); /* at rest at a stop there is no linear model, creep is no rest */
  put(level, ROTORS, FBL_UNBALANCED, FBL_GIVEN, FBL_ON_BOOM);
  put(level, LOOP, PLANAR, PLANAR, HINGE);
  put(level, BODIES, 3, 4, 2);                               /* Newton's method by differences takes long */
  if (level[ROOT] == ROOT_FREE && level[SPRING] != MOORED) { /* nothing that pushes it */
    level[LOAD] = level[GRAVITY] = 0;
    put(level, SPRING, NO_SPRING, CORD, level[BODIES] > 0 ? BETWEEN : NO_SPRING);
  }
  put(level, LOAD, DISTRIBUTED, DISTRIBUTED, FOLLOWER);
  *status = near_by(level);
  if (*status != FB_OK) {
    return 0;
  }
  spins = now[GRAVITY] == FBL_NO_GRAVITY && now[LOAD] != DEAD &&
          (now[SPRING] == NO_SPRING || (now[SPRING] == BETWEEN && now[BODIES] > 0)) && now[LOOP] == NO_LOOP;
  input_fill(&steady, 0.0);
  memset(steady.rotor, 0, sizeof steady.rotor);
  for (int j = 0; j < n_body + desc.n_loop; j++) {
    fb_drive *const d = &steady.drive[j];
    const int root = j == slot[0] && mechanism.joint[j].kind == FB_JOINT_FREE;
    memset(d->acceleration, 0, sizeof d->acceleration);
    memset(d->rate, 0, (root && spins ? 3 : 6) * sizeof d->rate[0]);
    if (root && now[ROOT] == ROOT_FREE && spins) {
      fbl_axial(&d->rate[3], 0.3, 0.2, 0.5, 0, 0, -1);
    }
  }
  for (int s = 0; s < n_body; s++) {
    memset(start[s].speed, 0, sizeof start[s].speed);
    memset(start[s].q_dot, 0, sizeof start[s].q_dot);
    memset(start[s].rotor_speed, 0, sizeof start[s].rotor_speed);
  }
  *status = fb_system_state_init(&mechanism, model, &state, &work, start, &steady);
  if (*status == FB_OK) {
    const fb_status found = fb_system_trim(&mechanism, model, &state, &analyse, &steady);
    switch (found) {
    case FB_OK:
      return 1;
    case FB_ERR_UNREST:
    case FB_ERR_SINGULAR:
    case FB_ERR_CONVERGENCE:
    case FB_ERR_CONTRADICTION:
    case FB_ERR_RANGE:
      return 0;
    default:
      *status = found;
    }
  }
  return 0;
}

/* What is steady stays, but for the error of the steps: as a momentum of the root relative to its frame turns, rk4 errs by h^5. */
static double trimmed(double h)
{
  static look first, second;
  static fb_system_state at;
  fb_status status;
  double miss = 0.0, step;
  if (!trim(&status)) {
    FBL_TRY(status);
    return FBL_NONE;
  }
  step = h * step_of(&status, 0);
  FBL_TRY(status);
  at = state;
  FBL_TRY(look_at(&first, &at, &steady));
  for (int k = 0; k < 10; k++) {
    FBL_TRY(step_steady(&at, step));
  }
  FBL_TRY(look_at(&second, &at, &steady));
  for (int s = 0; s < n_body; s++) {
    const int k = body_of[s];
    for (int i = 0; i < axes_of(kind[k]) && kind[k] != FB_JOINT_FREE; i++) {
      const double unit = (double)fbl_unit(1.0, 0, slides(kind[k], i), -1),
                   speed = (double)second.motion.joint[s].speed[i];
      miss = larger(miss, mechanism.joint[s].n_axis > i && state.mode[s][is_ball(kind[k]) ? 0 : i] == FB_AXIS_FREE
                              ? fabs(speed) / unit
                              : 0.0);
      miss =
          larger(miss, i < 3 ? fabs((double)first.motion.joint[s].value[i] - (double)second.motion.joint[s].value[i]) /
                                   ((double)fbl_unit(1.0, 0, slides(kind[k], i), 0))
                             : 0.0);
    }
    for (int n = 0; n < body(k)->n_node; n++) {
      miss = larger(miss, fbl_difference(first.node[k][n].displacement, second.node[k][n].displacement, 3) /
                              (double)fbl_unit(size, 0, 1, 0));
    }
  }
  return miss;
}

/* Outputs of a system as its ports have them. */
static fb_status outputs(fb_real *y, const fb_linear_desc *d, const fb_system_state *at)
{
  static look now_;
  fb_status status = look_at(&now_, at, &steady);
  for (int o = 0; o < d->n_out && status == FB_OK; o++) {
    const fb_port *const p = &d->out[o];
    const fb_node_motion *const node = &now_.node[body_of[p->kind == FB_PORT_LENGTH ? 0 : p->body]][p->node];
    fb_real R[9], g[3];
    fb_imu imu;
    status = fb_body_gravity_eval(body(body_of[p->body]), g, node->position);
    fb_imu_eval(&imu, node, g);
    fb_quat_to_mat33(R, node->quat);
    y[o] = p->kind == FB_PORT_DISPLACEMENT ? node->displacement[p->axis]
           : p->kind == FB_PORT_RATE       ? imu.angular_rate[p->axis]
           : p->kind == FB_PORT_COORDINATE ? now_.motion.joint[p->body].value[p->axis]
           : p->kind == FB_PORT_SPEED      ? now_.motion.joint[p->body].speed[p->axis]
           : p->kind == FB_PORT_LENGTH     ? now_.motion.spring[p->body].length
                                           : imu.specific_force[p->axis];
  }
  return status;
}

static fb_linear linear;

static void ports_draw(fb_linear_desc *d)
{
  const int k = bodies_of(now) - 1, s = slot[k], n = body(k)->n_node - 1;
  const fb_port in = {FB_PORT_FORCE, s, n, 1, FB_AXES_BODY}, turn = {FB_PORT_TORQUE, s, n, 2, FB_AXES_BODY};
  const fb_port out[] = {{FB_PORT_DISPLACEMENT, s, n, 1, FB_AXES_BODY}, {FB_PORT_RATE, s, n, 2, FB_AXES_BODY},
                         {FB_PORT_ACCELERATION, s, n, 1, FB_AXES_BODY}, {FB_PORT_COORDINATE, s, 0, 0, FB_AXES_BODY},
                         {FB_PORT_SPEED, s, 0, 0, FB_AXES_BODY},        {FB_PORT_LENGTH, 0, 0, 0, FB_AXES_BODY}};
  const int axes = !is_ball(kind[k]) && axes_of(kind[k]) > 0, free_ = axes && state.mode[s][0] == FB_AXIS_FREE;
  memset(d, 0, sizeof *d);
  d->in[d->n_in++] = in;
  d->in[d->n_in++] = turn;
  if (free_) {
    const fb_port drive = {FB_PORT_DRIVE, s, 0, 0, FB_AXES_BODY};
    d->in[d->n_in++] = drive;
  }
  if (desc.n_spring > 0) {
    const fb_port pull = {FB_PORT_PULL, 0, 0, 0, FB_AXES_BODY};
    d->in[d->n_in++] = pull;
  }
  for (int o = 0; o < FBL_COUNT(out); o++) {
    if ((o < 3 || axes || out[o].kind == FB_PORT_LENGTH) && (out[o].kind != FB_PORT_LENGTH || desc.n_spring > 0)) {
      d->out[d->n_out++] = out[o];
    }
  }
}

/* Adds an input at a port. */
static void port_push(const fb_port *p, double x)
{
  if (p->kind == FB_PORT_DRIVE) {
    steady.drive[p->body].torque[p->axis] += (fb_real)x;
  } else if (p->kind == FB_PORT_PULL) {
    steady.pull[p->body] += (fb_real)x;
  } else {
    fb_system_load *const load = &steady.load[steady.n_load++];
    memset(load, 0, sizeof *load);
    load->body = p->body;
    load->load.node = p->node;
    load->load.axes = FB_AXES_BODY;
    (p->kind == FB_PORT_FORCE ? load->load.force : load->load.torque)[p->axis] = (fb_real)x;
  }
}

/* Is there a body with nonlinear strain? Membrane forces are EA times what is rounded: at steps of 0.2 to 0.02 of the limit
   one model misses by 6e-6, 3e-5, 8e-7 and 4e-6. */
static int strained(void)
{
  int is = 0;
  for (int k = 0; k < n_body; k++) {
    is |= (model[mechanism.model[k]].effects & FB_EFFECT_NONLINEAR_STRAIN) != 0;
  }
  return is;
}

/* The answer of a linear model to a push is the derivative of that of the system. */
static double linear_models(double h)
{
  static fb_system_input plain;
  static fb_system_state at;
  fb_linear_desc d;
  fb_status status;
  double miss = 0.0, step;
  enum { N = 8 };
  if (!trim(&status)) {
    FBL_TRY(status);
    return FBL_NONE;
  }
  step = 0.1 * step_of(&status, 0);
  FBL_TRY(status);
  ports_draw(&d);
  status = fb_system_linearize(&mechanism, model, &analyse, &linear, &state, &steady, &d);
  if (status == FB_ERR_CAPACITY) {
    return FBL_NONE;
  }
  FBL_TRY(status);
  plain = steady;
  for (int port = 0; port < d.n_in; port++) {
    fb_real y[4][FB_MAX_PORTS];
    double own[FB_MAX_PORTS];
    for (int run = 0; run < 4; run++) {
      at = state;
      steady = plain;
      port_push(&d.in[port], (run == 0 ? 1.0 : run == 1 ? -1.0 : run == 2 ? 2.0 : -2.0) * h);
      for (int k = 0; k < N; k++) {
        FBL_TRY(step_steady(&at, step));
      }
      FBL_TRY(outputs(y[run], &d, &at));
    }
    steady = plain;
    fbl_respond(own, &linear, port, 1.0, step, N);
    for (int o = 0; o < d.n_out; o++) {
      const double slope =
          (8.0 * ((double)y[0][o] - (double)y[1][o]) - ((double)y[2][o] - (double)y[3][o])) / (12.0 * h);
      miss = larger(miss, fabs(slope - own[o]) / (fabs(slope) + fabs(own[o]) + 1e-3));
    }
  }
  return strained() ? 0.1 * miss : miss;
}

/* ---- what becomes of a model, to compare precisions by */

static fb_status digest(void)
{
  static look end;
  fb_status status;
  const double step = fbl_step(0.1 * step_of(&status, 0));
  /* where an open loop closes depends on the rows taken for independent; a center is of double precision alone */
  if (loops_of(now) > 0 || now[GRAVITY] == FBL_CENTER) {
    return FB_ERR_UNSUPPORTED;
  }
  status = status ? status : motion_of(&end, step, STEPS);
  for (int k = 0; k < n_body && status == FB_OK; k++) {
    for (int i = 0; i < 3; i++) {
      fbl_say((double)end.node[k][0].position[i], size);
    }
  }
  return status;
}

/* ---- the list */

static const fbl_law laws[] = {
    {"velocities_are_derivatives", "E9.1 E9.5", velocities, 0.01, {1e-7, 3e-2}},
    {"loads_are_told_how_points_move", "E14.40", points, 0.01, {1e-7, 0}},
    {"accelerations_are_derivatives", "E9.18 E9.19", accelerations, 0.01, {1e-6, 0}},
    {"imus_read_derivatives", "E8.20 E9.19", imus, 0.01, {1e-6, 0}},
    {"coordinates_and_their_rates", "E9.5 E9.19", coordinates, 0.01, {1e-6, 0}},
    {"joints_and_their_rates", "E9.5 E9.19", joints, 0.01, {1e-6, 0}},
    {"energy_changes_by_power", "E9.11 E9.14 E9.15", energy_rate, 0.01, {1e-7, 0}},
    {"power_of_motors", "E9.11 E9.26", powers, 0.01, {1e-7, 0}},
    {"joints_act_along_their_axes", "E9.11 E9.28 E9.29", efforts, 0.01, {1e-9, 0}},
    {"momenta_of_bodies_change_by_joints", "E9.14 E9.15 E9.19", momenta_of_bodies, 0.01, {1e-6, 0}},
    {"momenta_change_by_what_is_outside", "E9.15 E9.16", momenta, 0.01, {1e-6, 0}},
    {"reactions_are_resultants_of_joints", "E9.19", reactions, 0.01, {1e-9, 0}},
    {"lines_bear_what_they_bear_alone", "E14.41", loads_within, 0.01, {1e-9, 0}},
    {"latches_are_impacts_within", "E9.10 E9.15", latches, 0.0, {1e-8, 0}},
    {"turned_and_shifted", "E9.15", turned_and_shifted, 0.0, {1e-8, 0}},
    {"other_units", "E9.15", other_units, 0.0, {1e-8, 0}},
    {"mirror_image", "E9.15", mirrored, 0.0, {1e-8, 0}},
    {"order_of_bodies_and_loads", "E9.5 E9.15", reordered, 0.0, {1e-8, 0}},
    {"boosted", "E9.21 E9.23", boosted, 0.0, {1e-8, 0}},
    {"methods_agree", "E9.5 E9.10 E9.19", other_methods, 0.0, {1e-7, 0}},
    {"joint_closed_as_a_loop", "E9.10 E9.19", closed_joints, 0.0, {1e-7, 0}},
    {"open_loops_close_steadily", "E9.17", open_loops, 0.0, {1e-7, 0}},
    {"locked_joint_is_rigid", "E9.1 E9.19", locked_joints, 0.0, {1e-7, 0}},
    {"system_of_one_body", "E8.17 E9.15", one_body, 0.0, {1e-7, 0}},
    {"rk4_has_order_4", "E11.12", order_of_rk4, 0.4, {0.5, 0}},
    {"sdirk_converges_to_it_with_order_2", "E11.14", order_of_sdirk, 0.2, {0.5, 0}},
    {"long_steps_of_small_motions", "E11.14 E11.15", small_steps, 1e-5, {1e-6, 0}},
    {"convergence_is_told_in_any_attitude", "E11.25", convergence, 0.0, {1e-2, 0}},
    {"limits_of_steps", "E11.12", limits, 0.0, {0.5, 0}},
    {"limits_hold", "E11.12 E11.46", limits_hold, 1e-4, {0.5, 0}},
    {"models_and_their_check_words", "E9.1", words, 0.0, {0.5, 0}},
    {"what_is_wrong_is_refused", "E9.1 E9.15", wrong, 0.0, {0.5, 0.5}},
    {"dirty_work_gives_the_same_bits", "E9.15", dirt, 0.0, {1e-300, 0}},
    {"what_is_absent_is_zero", "E9.15 E11.12", absent, 0.0, {0.5, 0.5}},
    {"trimmed_stays_at_rest", "E12.1", trimmed, 0.1, {1e-7, 0}},
    {"linear_models_are_derivatives", "E12.9", linear_models, 0.01, {1e-5, 0}},
};

const fbl_kind fbl_system = {"system", features, FBL_COUNT(features), legal, draw, laws, FBL_COUNT(laws), digest};
