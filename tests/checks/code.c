/* Bodies and systems of them on joints, as a table, and their generated step (--code). With WRITE: `write NAME
   [--single] [--sdirk] [--lanes] [--loads] [--vary LIST]` prints the step of that model, without a name all names.
   Else (code.awk makes members.h of the text): 1,000 steps beside the library's, unloaded and loaded, differ by at
   most TOLERANCE of the extremes; motion, nodes and energy are the library's; what it refuses is refused with its
   status. */
#include "flexbeam.h"
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef WRITE
#include "examples/tools/code_body.h"
#include "examples/tools/code_tree.h"
#else
#define generated_IMPLEMENTATION
#include "code.h"
#endif

/* ---- the models */

/* clang-format off */
enum { RIGID, BOOM, PANEL, WHEEL, HUB, MAST, BENT, VANE, CRAFT, STRAINED, SWEPT, MODELS };
/* A rigid body; with a beam of 4, of 2 modes; a wheel, which turns fast about its hinge; HUB and MAST: as RIGID and
   BOOM with rotors inside; BENT and VANE: lines of large deflection of 6 and 2 modes; CRAFT: two beams turned at
   random; STRAINED: nonlinear strain; SWEPT: rotors, two lines that are curved, twisted, tapered, off their axes, and
   a part that is no beam. */
enum { TIP = 8, GIVEN = 16, RUBS = 32, LOCKED = 64, GIVEN_2 = 128, LOCKED_2 = 256 };
/* GIVEN: the axis of its joint is prescribed; LOCKED: it is that; _2: its second axis; RUBS: it has friction and
   stops, which it reaches. TIP: the node there carries the joint. */
enum { ROOT = FB_JOINT_FREE, WELD = FB_JOINT_RIGID, HINGE = FB_JOINT_REVOLUTE, SLIDE = FB_JOINT_PRISMATIC, TUBE = FB_JOINT_CYLINDRICAL,
       SCREW = FB_JOINT_SCREW, CROSS = FB_JOINT_UNIVERSAL, BALL = FB_JOINT_SPHERICAL };
enum { ALONE = 20, FREE = ALONE + FB_BASE_FREE, PRESCRIBED = ALONE + FB_BASE_PRESCRIBED, PINNED = ALONE + FB_BASE_PINNED,
       HINGED = ALONE + FB_BASE_HINGED }; /* no joint: a body on the base */
enum { LINEAR = FB_EFFECTS_LINEAR, SPIN = FB_EFFECTS_SPIN, FULL = FB_EFFECTS_FULL, STIFFENED = FB_EFFECT_ACCELERATION_STIFFENING,
       DAMPING = FB_EFFECT_DAMPING, DAMPED = FB_EFFECTS_FULL | FB_EFFECT_DAMPING };
enum { HARD = 1000 }; /* SDIRK: times the stiffness of joints and modes */
enum { UNIFORM = 1, CENTER = 2, APART = 4, MIXED = 8, ORBIT = 16, UNBALANCED = 32, BRAKED = 64, BOUNDING = 128 };
/* Gravity: of a center on all bodies; that of rigid ones of another center; or uniform on these; of the Earth, in a
   low orbit. BRAKED, BOUNDING, of SDIRK: friction of rotors bounds the step unless long ones are allowed; dampers
   bound it */
enum { AHEAD, PLAIN, PLANE, DOOR, RANDOM };
/* Joints: AHEAD: nothing is random, one ahead, one behind; PLAIN: turned about x; PLANE: all axes along z; DOOR: on
   that of the first joint, whose loop moves nothing; RANDOM: turned at random */
enum { IDLE, PULLED, MUSCLE, MET };
/* Springs: without an actuator, with one, nothing but that; MET: pulled, between points that meet at zero coordinates
   */

typedef struct hang {
  int joint, parent, model;
} hang;

typedef struct tie {
  int body[2];
  double length; /* [m] 0: without a damper */
  int pull;
} tie;

/* Loops close at zero coordinates; RUBS, of the child: with spring and damper, and friction and stops if it is not
   spherical. */
static const struct {
  const char *name;
  unsigned effects;
  int with, turned;
  hang link[5], loop[2];
  tie spring[4];
} models[] = {
    {"craft", DAMPED, 0, 0, .link = {{FREE, -1, CRAFT}}},
    {"rigid", FULL, UNIFORM, 0, .link = {{FREE, -1, RIGID}}},
    {"linear", LINEAR | DAMPING, 0, 0, .link = {{FREE, -1, CRAFT}}},
    {"spin", SPIN | STIFFENED, 0, 0, .link = {{PINNED, -1, CRAFT}}},
    {"pinned", DAMPED, UNIFORM, 0, .link = {{PINNED, -1, CRAFT}}},
    {"prescribed", DAMPED, UNIFORM, 0, .link = {{PRESCRIBED, -1, CRAFT}}},
    {"hinged", DAMPED, UNIFORM, 0, .link = {{HINGED, -1, CRAFT}}},
    {"strain", 3u | FB_EFFECT_RESIDUAL_INERTIA | FB_EFFECT_NONLINEAR_STRAIN | DAMPING, 0, 0, .link = {{FREE, -1, STRAINED}}},
    {"wheels", DAMPED, 0, 0, .link = {{FREE, -1, MAST}}},
    {"wheels_pinned", SPIN, UNIFORM, 0, .link = {{PINNED, -1, HUB}}},
    {"wheels_prescribed", DAMPED, UNIFORM | UNBALANCED, 0, .link = {{PRESCRIBED, -1, MAST}}},
    {"unbalanced", DAMPED, UNBALANCED, 0, .link = {{FREE, -1, MAST}}},
    {"central", FULL, CENTER, 0, .link = {{FREE, -1, MAST}}},
    {"central_rigid", FULL, CENTER | UNIFORM, 0, .link = {{PRESCRIBED, -1, HUB}}},
    {"falling", DAMPED, CENTER, 0, .link = {{FREE, -1, CRAFT}}},
    {"line", DAMPED, CENTER, 0, .link = {{FREE, -1, BENT}}},
    {"line_hinged", DAMPED, UNIFORM, 0, .link = {{HINGED, -1, VANE}}},
    {"swept", DAMPED, CENTER, 0, .link = {{FREE, -1, SWEPT}}},
    {"swept_pinned", DAMPED, UNIFORM, 0, .link = {{PINNED, -1, SWEPT}}},
    {"line_prescribed", DAMPED, UNIFORM, 0, .link = {{PRESCRIBED, -1, VANE}}},
    {"hinge", FULL, 0, AHEAD, .link = {{ROOT, -1, RIGID}, {HINGE, 0, RIGID}}},
    {"booms", FULL, 0, AHEAD, .link = {{ROOT, -1, RIGID}, {HINGE, 0, BOOM}, {HINGE, 0, BOOM}}},
    {"turned", FULL, 0, RANDOM, .link = {{ROOT, -1, RIGID}, {HINGE, 0, RIGID}}},
    {"screw", FULL, UNIFORM, RANDOM, .link = {{ROOT, -1, RIGID}, {SCREW, 0, PANEL}, {CROSS, 0, RIGID}, {WELD, 2, BOOM}}},
    {"ball", FULL, 0, RANDOM, .link = {{ROOT, -1, RIGID}, {BALL, 0, BOOM}, {WELD, 0, PANEL}, {HINGE, 1, RIGID}}},
    {"grounded", DAMPED, UNIFORM, RANDOM, .link = {{BALL, -1, RIGID}, {HINGE, 0, BOOM}, {SLIDE, -1, PANEL}}},
    {"free_linear", LINEAR, 0, PLAIN, .link = {{ROOT, -1, PANEL}, {BALL, 0, BOOM}}},
    {"free_spin", SPIN | STIFFENED | DAMPING, 0, RANDOM, .link = {{ROOT, -1, RIGID}, {SLIDE, 0, BOOM}, {SLIDE, 1, RIGID}}},
    {"driven", FULL, 0, PLAIN, .link = {{HINGE, -1, RIGID}, {SCREW, 0, PANEL | GIVEN}, {BALL, 1, BOOM}, {SLIDE, 1, RIGID | GIVEN}, {CROSS, 3, RIGID}}},
    {"stops", FULL, 0, RANDOM, .link = {{ROOT, -1, RIGID}, {HINGE, 0, BOOM | RUBS}, {CROSS, 0, RIGID | RUBS}, {SLIDE, 2, RIGID | RUBS}}},
    {"stops_grounded", DAMPED, UNIFORM, PLAIN, .link = {{HINGE, -1, RIGID | RUBS}, {SCREW, 0, PANEL | RUBS}, {TUBE, -1, RIGID | RUBS}, {HINGE, -1, RIGID | RUBS | GIVEN}}},
    {"bars", FULL, 0, PLANE, .link = {{HINGE, -1, RIGID}, {HINGE, 0, RIGID}, {HINGE, -1, RIGID}}, .loop = {{HINGE, 1, 2}}},
    {"two_loops", SPIN, UNIFORM, RANDOM, .link = {{CROSS, -1, RIGID}, {HINGE, 0, BOOM}, {BALL, 1, PANEL}, {TUBE, 2, RIGID}}, .loop = {{BALL, 0, 2}, {CROSS, -1, 3}}},
    {"deploys", FULL, 0, PLANE, .link = {{ROOT, -1, RIGID}, {HINGE, 0, RIGID}, {HINGE, 1, RIGID}, {HINGE, 0, RIGID}}, .loop = {{HINGE, 2, 3}}},
    {"loops", SPIN | DAMPING, 0, RANDOM, .link = {{ROOT, -1, RIGID}, {HINGE, 0, BOOM}, {BALL, 1, RIGID}, {HINGE, -1, PANEL}, {BALL, 3, RIGID}}, .loop = {{TUBE, 0, 2}, {BALL, -1, 4}}},
    {"door", FULL, 0, DOOR, .link = {{HINGE, -1, RIGID}, {SLIDE, -1, PANEL}}, .loop = {{HINGE, -1, 0 + RUBS}}},
    {"arm", FULL, 0, PLANE, .link = {{HINGE, -1, PANEL}, {HINGE, 0 + TIP, PANEL}}},
    {"tips", SPIN | DAMPING, 0, RANDOM, .link = {{CROSS, -1, RIGID}, {WELD, 0, PANEL}, {WELD, 1 + TIP, RIGID}, {HINGE, 2, PANEL}, {SCREW, 3 + TIP, PANEL}}},
    {"tip_driven", SPIN, 0, RANDOM, .link = {{ROOT, -1, RIGID}, {HINGE, 0, PANEL | GIVEN}, {SLIDE, 1 + TIP, RIGID | LOCKED}, {HINGE, 2, BOOM}}},
    {"hinged_wheels", DAMPED, 0, RANDOM, .link = {{ROOT, -1, RIGID}, {HINGE, 0, WHEEL}, {HINGE, 0, BOOM}, {HINGE, 2, WHEEL}}},
    {"rotors", DAMPED, BRAKED, RANDOM, .link = {{ROOT, -1, HUB}, {HINGE, 0, MAST}, {HINGE, 0, BOOM}}},
    {"rotors_linear", LINEAR, UNIFORM, RANDOM, .link = {{ROOT, -1, MAST}, {CROSS, 0, HUB}, {HINGE, 1, WHEEL}}},
    {"rotors_tip", DAMPED, 0, RANDOM, .link = {{ROOT, -1, RIGID}, {HINGE, 0, MAST}, {CROSS, 1 + TIP, HUB}, {HINGE, 1 + TIP, WHEEL}}},
    {"loop_tip", FULL, UNIFORM | BOUNDING, RANDOM, .link = {{BALL, -1, PANEL}, {CROSS, 0 + TIP, RIGID}, {HINGE, 0, BOOM | RUBS}}, .loop = {{BALL, 0 + TIP, 2 + TIP + RUBS}, {TUBE, -1, 1}}},
    {"tied_crank", SPIN, 0, RANDOM, .link = {{ROOT, -1, PANEL}, {BALL, 0 + TIP, RIGID}, {HINGE, -1, RIGID | GIVEN}, {HINGE, -1, PANEL}}, .loop = {{BALL, 2, 1}, {CROSS, 3 + TIP, 0 + TIP}}},
    {"tied", FULL, UNIFORM, RANDOM, .link = {{ROOT, -1, HUB}, {HINGE, 0, RIGID}, {HINGE, 0, WHEEL}}, .loop = {{BALL, -1, 1}}},
    {"locked", FULL, UNIFORM, RANDOM, .link = {{ROOT, -1, RIGID}, {HINGE, 0, BOOM | LOCKED | RUBS}, {HINGE, 1, WHEEL}, {HINGE, 0, PANEL | GIVEN}, {SCREW, -1, RIGID | LOCKED}}},
    {"springs", DAMPED, 0, RANDOM, .link = {{HINGE, -1, PANEL}, {HINGE, 0 + TIP, BOOM}, {HINGE, 0 + TIP, RIGID}}, .spring = {{{0 + TIP, 2}, 1.5, IDLE}, {{-1, 1 + TIP}, 12.0, IDLE}}},
    {"muscles", FULL, UNIFORM | BOUNDING, RANDOM, .link = {{HINGE, -1, RIGID}, {HINGE, 0, RIGID}, {CROSS, 1, RIGID}}, .spring = {{{-1, 0}, 1.0, PULLED}, {{0, 2}, 0.0, MUSCLE}, {{1, 2 + TIP}, 0.0, PULLED}, {{0, 1}, 1.0, IDLE}}},
    {"met", DAMPED, 0, RANDOM, .link = {{HINGE, -1, PANEL}, {HINGE, 0 + TIP, BOOM}, {HINGE, 0 + TIP, RIGID | GIVEN}, {SLIDE, 2, RIGID}}, .spring = {{{0 + TIP, 1 + TIP}, 8.0, IDLE}, {{0 + TIP, 3}, 2.0, PULLED}, {{-1, 2}, 0.0, MUSCLE}, {{2, 3}, 0.0, MET}}},
    {"tether", DAMPED, 0, RANDOM, .link = {{ROOT, -1, RIGID}, {CROSS, 0, BOOM}}, .spring = {{{-1, 0}, 2.0, IDLE}, {{1 + TIP, -1}, 9.0, PULLED}}},
    {"moored", DAMPED, UNIFORM, RANDOM, .link = {{HINGE, -1, PANEL}, {ROOT, -1, PANEL}, {BALL, 1 + TIP, RIGID}, {HINGE, -1, RIGID | GIVEN}}, .spring = {{{0 + TIP, 1 + TIP}, 2.0, IDLE}, {{2, 0}, 0.0, MUSCLE}, {{3, 1}, 1.0, PULLED}, {{-1, 2 + TIP}, 6.0, IDLE}}},
    {"axes", DAMPED, 0, RANDOM, .link = {{ROOT, -1, RIGID}, {CROSS, 0, BOOM | LOCKED}, {TUBE, 0, PANEL | GIVEN_2}, {CROSS, 2, RIGID | GIVEN}}},
    {"axes_grounded", FULL, UNIFORM, RANDOM, .link = {{CROSS, -1, RIGID | LOCKED_2 | RUBS}, {TUBE, 0, PANEL | GIVEN | RUBS}, {BALL, 1, RIGID | GIVEN}}},
    {"axes_ball", SPIN | DAMPING, 0, RANDOM, .link = {{ROOT, -1, PANEL}, {BALL, 0 + TIP, BOOM | LOCKED}, {CROSS, 0 + TIP, HUB | GIVEN | LOCKED_2}, {HINGE, 0, WHEEL}}},
    {"axes_two", FULL, 0, RANDOM, .link = {{ROOT, -1, RIGID}, {BALL, 0, BOOM | GIVEN}, {CROSS, 0, PANEL | GIVEN_2}, {CROSS, 2, RIGID | LOCKED_2}}},
    {"loop_locked", DAMPED, UNIFORM, RANDOM, .link = {{HINGE, -1, RIGID}, {BALL, 0, BOOM}, {CROSS, -1, PANEL}, {HINGE, 2, RIGID}}, .loop = {{CROSS, 1 + TIP, 3 + LOCKED_2 + RUBS}}},
    {"loop_axes", FULL, 0, RANDOM, .link = {{ROOT, -1, RIGID}, {CROSS, 0, BOOM}, {BALL, 0, BOOM}, {CROSS, 2, RIGID}}, .loop = {{TUBE, 1 + TIP, 3 + LOCKED + GIVEN_2}}},
    {"loop_ball", SPIN, 0, RANDOM, .link = {{HINGE, -1, RIGID}, {BALL, 0, BOOM}, {BALL, 1, RIGID}}, .loop = {{BALL, -1, 2 + GIVEN}}},
    {"loop_screw_locked", FULL, 0, RANDOM, .link = {{ROOT, -1, PANEL}, {CROSS, 0, BOOM}, {BALL, 1, RIGID}, {CROSS, 2, PANEL}}, .loop = {{SCREW, 0, 3 + TIP + LOCKED + RUBS}}},
    {"door_driven", FULL, 0, DOOR, .link = {{HINGE, -1, RIGID}, {SLIDE, -1, PANEL}}, .loop = {{HINGE, -1, 0 + GIVEN}}},
    {"falls", DAMPED, CENTER, RANDOM, .link = {{ROOT, -1, RIGID}, {HINGE, 0, BOOM}}},
    {"falls_apart", DAMPED, CENTER | APART, RANDOM, .link = {{ROOT, -1, RIGID}, {HINGE, 0, BOOM}, {BALL, 0, PANEL}, {HINGE, 1, WHEEL}}},
    {"falls_driven", FULL, CENTER | MIXED, RANDOM, .link = {{ROOT, -1, PANEL}, {HINGE, 0, BOOM | GIVEN}, {SCREW, 0, RIGID | RUBS}, {HINGE, -1, PANEL}}, .spring = {{{0, 1 + TIP}, 9.0, IDLE}}},
    {"orbit", FULL, CENTER | ORBIT, RANDOM, .link = {{ROOT, -1, RIGID}, {HINGE, 0, BOOM}, {HINGE, 0, WHEEL}}},
    {"lines", FULL, 0, PLAIN, .link = {{ROOT, -1, RIGID}, {HINGE, 0, BENT}}},
    {"lines_two", DAMPED, 0, RANDOM, .link = {{ROOT, -1, RIGID}, {HINGE, 0, BENT}, {HINGE, 0, VANE}}},
    {"lines_chain", DAMPED, UNIFORM, RANDOM, .link = {{HINGE, -1, VANE}, {BALL, 0 + TIP, BENT}, {SLIDE, 1 + TIP, RIGID}}},
    {"lines_loop", DAMPED, 0, RANDOM, .link = {{HINGE, -1, VANE}, {CROSS, 0 + TIP, RIGID}, {BALL, -1, VANE}}, .loop = {{BALL, 1, 2 + TIP}}},
    {"lines_spring", DAMPED, 0, RANDOM, .link = {{ROOT, -1, RIGID}, {HINGE, 0, VANE | GIVEN}, {WELD, 0, VANE}, {HINGE, 2, WHEEL}}, .spring = {{{1 + TIP, 2 + TIP}, 8.0, IDLE}, {{0, 2 + TIP}, 9.0, IDLE}}},
    {"lines_rotors", SPIN | DAMPING, UNIFORM, RANDOM, .link = {{ROOT, -1, HUB}, {HINGE, 0, VANE | RUBS}, {TUBE, 0, MAST}}},
    {"two_free", DAMPED, 0, RANDOM, .link = {{ROOT, -1, RIGID}, {HINGE, 0, BOOM}, {ROOT, -1, PANEL}, {CROSS, 2, RIGID | RUBS}}, .spring = {{{0, 3}, 3.0, PULLED}}},
    {"two_fall", FULL, CENTER, RANDOM, .link = {{ROOT, -1, HUB}, {ROOT, -1, RIGID}, {HINGE, 1, MAST}}},
};
/* clang-format on */

static fb_body model[MODELS];
static fb_system_desc desc;
static fb_system mechanism;
static fb_system_work work;
static int which, alone;                    /* the model; a single body, model[desc.model[0]] */
static unsigned char pulls[FB_MAX_SPRINGS]; /* 1: the spring has an actuator */
static int met = -1;                        /* one whose points meet at zero coordinates */
static double hard = 1;
static fb_body_factors hub; /* of the body built last */

static double random_number(void)
{
  static unsigned long seed = 4711;
  seed = (1103515245ul * seed + 12345ul) & 0x7ffffffful;
  return (double)seed / 1073741824.0 - 1.0;
}

static void random_vector(fb_real out[3], double by)
{
  for (int i = 0; i < 3; i++) {
    out[i] = (fb_real)(by * random_number());
  }
}

static void need(fb_status status, const char *what)
{
  if (status != FB_OK) {
    fprintf(stderr, "%s: %s: %s\n", models[which].name, what, fb_status_string(status));
    exit(1);
  }
}

static void build_gravity(fb_body_desc *level, int rigid)
{
  const int with = models[which].with, mixed = with & MIXED && rigid;
  const int center = with & CENTER && !mixed, uniform = with & UNIFORM || mixed;
  level->effects |= uniform ? FB_EFFECT_GRAVITY : 0u;
  level->gravity[1] = uniform ? FB_R(0.5) : FB_R(0.0);
  level->gravity[2] = uniform ? FB_R(-2.0) : FB_R(0.0);
  if (center) { /* of SDIRK one that is not met in its longer steps */
    level->mu = with & ORBIT ? FB_R(3.986004418e14) : hard > 1 ? FB_R(60.0) : FB_R(400.0);
    level->center[0] = with & ORBIT ? FB_R(-7e6) : with & APART && rigid ? FB_R(25.0) : FB_R(-30.0);
    level->center[1] = FB_R(20.0);
    level->center[2] = FB_R(25.0);
  }
}

/* Rotors inside a body: two on the frame, one at its tip if it has one, else one of given momentum. */
static void build_rotors(fb_body_desc *level, int tip)
{
  const double brake = models[which].with & BRAKED ? hard : 1;
  level->n_rotor = tip > 0 ? 3 : 2;
  for (int r = 0; r < level->n_rotor; r++) {
    fb_rotor *const rotor = &level->rotor[r];
    rotor->node = r == 2 ? tip : 0;
    random_vector(rotor->axis, 1);
    rotor->axis[1] = FB_R(1.0);
    rotor->inertia = FB_R(0.1);
    rotor->damping = (fb_real)(0.002 * brake);
    rotor->friction = r == 0 ? FB_R(0.0) : (fb_real)(0.01 * brake);
    rotor->friction_speed = FB_R(2.0);
    rotor->given = tip == 0 && r == 1;
  }
  if (models[which].with & UNBALANCED) {
    level->rotor[0].static_imbalance = FB_R(1e-3);
    level->rotor[0].dynamic_imbalance = FB_R(2e-3);
    level->rotor[0].dynamic_phase = FB_R(0.5);
  }
}

/* A curved line of two sections, with masses, shear centers and a lumped body off its axis. */
static void build_swept(fb_beam_desc *boom)
{
  const int n = boom->n_element;
  fb_section *const root = &boom->station[0], *const tip = &boom->station[1];
  fb_lump *const lump = &boom->lump[0];
  root->EA = root->GA_y = root->GA_z = FB_R(1e6);
  root->GJ = FB_R(2000.0);
  root->i_y = root->i_z = root->mass_y = root->shear_z = FB_R(0.02);
  *tip = *root;
  tip->EI_y *= FB_R(0.3);
  tip->mass = FB_R(0.7);
  tip->twist = FB_R(0.3);
  boom->n_station = 2;
  boom->n_lump = 1;
  lump->node = n;
  lump->mass = FB_R(2.0);
  lump->center[1] = FB_R(-0.05);
  lump->inertia[0] = lump->inertia[1] = lump->inertia[2] = FB_R(0.1);
  boom->n_point = n + 1;
  boom->length = FB_R(0.0);
  for (int j = 1; j <= n; j++) {
    fb_real *const x = boom->point[j], *const before = boom->point[j - 1];
    x[0] = (fb_real)j;
    x[1] = FB_R(0.02) * (fb_real)(j * j);
    x[2] = FB_R(0.03) * (fb_real)j;
    const fb_real step[3] = {x[0] - before[0], x[1] - before[1], x[2] - before[2]};
    boom->length += (fb_real)sqrt((double)fb_vec3_dot(step, step));
  }
  tip->x = boom->length;
}

/* A part that is no beam: two bodies that the last coordinate moves and turns. */
static void build_panel(fb_shape *shape)
{
  const int n = shape->n, a = n - 1;
  static const fb_real inertia[6] = {FB_R(0.1), FB_R(0.1), FB_R(0.1), 0, 0, 0};
  static fb_real psi[3 * FB_MAX_MODES], theta[3 * FB_MAX_MODES];
  for (int j = 1; j < 3; j++) {
    const fb_real r[3] = {0, -(fb_real)j, FB_R(0.1)};
    psi[3 * a + 2] = FB_R(0.25) * (fb_real)(j * j);
    theta[3 * a] = -FB_R(0.5) * (fb_real)j;
    need(fb_shape_add_lump(shape, FB_R(2.0), r, inertia, psi, theta), "panel");
  }
  shape->K[a * (n + 1)] = FB_R(4.0) * shape->M[a * (n + 1)];
}

/* Adds a beam of that many modes, its coordinates from `first` on; its tip is a node. */
static void build_beam(fb_shape *shape, int kind, int first, int modes, int line)
{
  static fb_beam_desc boom;
  static fb_beam beam;
  static fb_modes basis;
  static fb_modes_work modes_work;
  static fb_modes_desc keep;
  const fb_real at = line && modes == 6 ? FB_R(0.83) : FB_R(1.0); /* between points */
  fb_real turn[3] = {0, 0, 0};
  int tip;
  memset(&boom, 0, sizeof boom);
  memset(&keep, 0, sizeof keep);
  boom.length = (fb_real)(6 + modes); /* 10 m with 4 modes */
  boom.n_element = kind == STRAINED ? 1 : 6;
  boom.n_station = 1;
  boom.station[0].mass = 1;
  boom.station[0].EI_y = (fb_real)(5000 * hard);
  boom.station[0].EI_z = (fb_real)(8000 * hard);
  boom.position[0] = models[which].turned == AHEAD && !alone ? FB_R(0.0) : FB_R(0.5);
  keep.count[FB_KIND_BEND_Y] = (modes + 1) / 2;
  keep.count[FB_KIND_BEND_Z] = modes / 2;
  keep.line_points = line ? 6 : 0;
  if (kind == CRAFT) { /* dense, and with torsion */
    random_vector(turn, 2);
    fb_quat_from_rotvec(boom.attitude, turn);
    random_vector(boom.position, 1);
    boom.station[0].GJ = FB_R(2000.0);
    boom.station[0].i_y = boom.station[0].i_z = FB_R(0.02);
    keep.count[FB_KIND_BEND_Y]--;
    keep.count[FB_KIND_TORSION] = 1;
  }
  if (kind == SWEPT) {
    build_swept(&boom);
  }
  if (kind == STRAINED) {
    boom.station[0].EA = FB_R(3e5);
    keep.basis = FB_BASIS_FUNCTIONS;
    keep.root_strain = 1;
    keep.count[0] = keep.count[1] = keep.count[2] = 2;
  }
  need(fb_beam_init(&beam, &boom), "beam");
  need(fb_modes_solve(&basis, &modes_work, &beam, &keep), "modes");
  need(fb_shape_add_beam(shape, first, &beam, &basis), "boom");
  need(fb_shape_add_beam_node(shape, &tip, first, &beam, &basis, at * boom.length), "tip");
  if (kind == STRAINED) {
    need(fb_shape_add_beam_strain(shape, first, &beam, &basis), "strain");
  }
}

/* A rigid body, with its beams. */
static void build_model(int kind)
{
  static fb_shape shape;
  static fb_body_work body_work;
  static fb_body_desc level;
  static const int count[MODELS] = {0, 4, 2, 0, 0, 4, 6, 2, 8, 7, 7};
  static const fb_real wheel[6] = {FB_R(0.3), FB_R(0.3), FB_R(0.5), 0, 0, 0}, still[3] = {0, 0, 0};
  const int n = count[kind], line = kind == BENT || kind == VANE || kind == SWEPT;
  const int beams = n == 0 ? 0 : kind == CRAFT || kind == SWEPT ? 2 : 1;
  const int plain = models[which].turned == AHEAD && !alone;
  fb_real center[3], inertia[6];
  random_vector(center, plain ? 0 : 0.3);
  random_vector(inertia, plain ? 0 : 1);
  random_vector(inertia + 3, plain ? 0 : 1);
  for (int i = 0; i < 3; i++) {
    inertia[i] += plain ? (i == 0 ? FB_R(4.0) : FB_R(9.0)) : FB_R(9.0) + FB_R(2.0) * (fb_real)i;
  }
  center[0] += plain ? FB_R(0.5) : FB_R(0.0);
  memset(&level, 0, sizeof level);
  level.effects = n > 0 ? models[which].effects | (line ? FB_EFFECTS_LARGE : 0u) : FB_EFFECTS_RIGID;
  level.base = alone ? (fb_base)(models[which].link[0].joint - ALONE) : FB_BASE_PRESCRIBED;
  build_gravity(&level, n == 0);
  for (int a = 0; a < n; a++) {
    level.zeta[a] = level.effects & FB_EFFECT_DAMPING ? FB_R(0.02) : FB_R(0.0);
  }
  need(fb_shape_init(&shape, n), "shape");
  need(kind == WHEEL ? fb_shape_add_rigid(&shape, FB_R(3.0), still, wheel)
                     : fb_shape_add_rigid(&shape, FB_R(20.0), center, inertia),
       "rigid body");
  hub.hub = FB_R(20.0);
  memcpy(hub.center, center, sizeof center);
  memcpy(hub.inertia, inertia, sizeof inertia);
  if (n == 0 && kind != WHEEL) {
    int node;
    need(fb_shape_add_node(&shape, &node, (const fb_real[3]){FB_R(0.7), FB_R(-0.4), FB_R(0.2)}, still, still), "node");
  }
  for (int k = 0; k < beams; k++) {
    build_beam(&shape, kind, k * (n / 2), n / beams, line);
  }
  if (kind == SWEPT) {
    build_panel(&shape);
  }
  if (kind == HUB || kind == MAST || kind == SWEPT) {
    build_rotors(&level, kind != HUB);
  }
  need(fb_body_init(&model[kind], &body_work, &shape, &level), "body");
  if (n == 2 && hard > 1) { /* as modes of a part that are not orthogonal */
    fb_body *const body = &model[kind];
    body->K.term[body->K.n_term].a = 0;
    body->K.term[body->K.n_term].b = 1;
    body->K.term[body->K.n_term++].c = FB_R(0.3) * body->K.diagonal[0];
  }
}

/* Friction, and stops within the reach of motion, of every axis of a joint. */
static void build_rubbing(fb_joint_desc *joint)
{
  const int axes = joint->kind == FB_JOINT_UNIVERSAL || joint->kind == FB_JOINT_CYLINDRICAL ? 2 : 1;
  for (int i = 0; i < axes; i++) {
    joint->friction[i] = FB_R(0.5);
    joint->friction_speed[i] = FB_R(0.1);
    joint->stop[i][0] = FB_R(-0.1);
    joint->stop[i][1] = FB_R(0.2);
    joint->stop_stiffness[i] = FB_R(400.0);
    joint->stop_loss[i] = i == 0 ? FB_R(0.5) : FB_R(0.0);
  }
}

static void build_joint(fb_joint_desc *joint, const hang *link, int turned)
{
  const int random = turned == RANDOM, flags = link->model;
  fb_real turn[3] = {turned == PLAIN ? FB_R(1.5707963267948966) : FB_R(0.0), 0, 0}, child[3] = {0, 0, 0};
  joint->kind = (fb_joint_kind)link->joint;
  joint->mode[0] = flags & GIVEN ? FB_AXIS_PRESCRIBED : flags & LOCKED ? FB_AXIS_LOCKED : FB_AXIS_FREE;
  joint->mode[1] = flags & GIVEN_2 ? FB_AXIS_PRESCRIBED : flags & LOCKED_2 ? FB_AXIS_LOCKED : FB_AXIS_FREE;
  joint->parent = link->parent >= TIP ? link->parent - TIP : link->parent;
  joint->parent_node = link->parent >= TIP;
  if (link->joint == ROOT) {
    return;
  }
  random_vector(joint->position, 1);
  if (random) {
    random_vector(joint->child_position, 0.3);
    random_vector(turn, 1);
    random_vector(child, 1);
  }
  fb_quat_from_rotvec(joint->attitude, turn);
  fb_quat_from_rotvec(joint->child_attitude, child);
  joint->pitch = link->joint == SCREW ? FB_R(0.2) : FB_R(0.0);
  for (int i = 0; i < 3 && link->joint != WELD && random; i++) {
    joint->stiffness[i] = (fb_real)(20 * hard);
    joint->damping[i] = FB_R(0.5);
    joint->rest[i] = link->joint == BALL ? FB_R(0.0) : (fb_real)(0.1 / sqrt(hard));
  }
  if (flags & RUBS) {
    build_rubbing(joint);
  }
}

/* The second body of a plain tree a meter ahead, the third one behind, turned by half a turn. */
static void build_plain_joint(fb_joint_desc *joint, int k)
{
  const fb_real turn[3] = {0, 0, k == 2 ? FB_R(3.14159265358979324) : FB_R(0.0)};
  memset(joint->position, 0, sizeof joint->position);
  joint->position[0] = k == 0 ? FB_R(0.0) : k == 1 ? FB_R(1.0) : -FB_R(1.0);
  fb_quat_from_rotvec(joint->attitude, turn);
}

/* A loop by joint frames that coincide at zero coordinates of the tree, which is built without it. */
static void build_loop(const hang *link)
{
  static fb_system_motion motion;
  static fb_system_state zero;
  fb_joint_desc *const loop = &desc.loop[desc.n_loop];
  const int child = link->model % GIVEN, of = child % TIP, rubs = link->model & RUBS;
  hang at = *link;
  fb_real turn[3], own[4] = {1, 0, 0, 0}, back[4], x[3], y[3], R[9];
  need(fb_system_state_init(&mechanism, model, &zero, &work, NULL, NULL), "state at zero");
  need(fb_system_motion_eval(&mechanism, model, &work, &motion, &zero, NULL), "poses at zero");
  at.model &= ~RUBS;
  build_joint(loop, &at, PLANE);
  loop->child = of;
  loop->child_node = child >= TIP;
  loop->pitch = loop->kind == FB_JOINT_SCREW ? FB_R(0.3) : FB_R(0.0);
  for (int i = 0; i < 3 && rubs; i++) {
    loop->stiffness[i] = FB_R(10.0);
    loop->damping[i] = hard > 1 && models[which].with & BOUNDING ? FB_R(40.0) : FB_R(0.4);
  }
  if (rubs && loop->kind != FB_JOINT_SPHERICAL) {
    loop->rest[0] = FB_R(0.05);
    build_rubbing(loop);
  }
  if (models[which].turned == DOOR) {
    memcpy(loop->position, desc.joint[0].position, sizeof loop->position);
  }
  random_vector(turn, models[which].turned == RANDOM ? 1 : 0);
  fb_quat_from_rotvec(loop->attitude, turn);
  for (int i = 0; i < 3; i++) {
    x[i] = loop->position[i] + (loop->parent_node ? model[desc.model[loop->parent]].node[1].r[i] : FB_R(0.0));
  }
  if (loop->parent >= 0) { /* to the ground */
    memcpy(own, motion.pose[loop->parent].quat, sizeof own);
    fb_quat_to_mat33(R, own);
    fb_mat33_mul_vec3(y, R, x);
    for (int i = 0; i < 3; i++) {
      x[i] = y[i] + motion.pose[loop->parent].rho[i];
    }
  }
  fb_quat_mul(back, own, loop->attitude);
  fb_quat_to_mat33(R, motion.pose[of].quat);
  own[0] = motion.pose[of].quat[0];
  for (int i = 0; i < 3; i++) {
    y[i] = x[i] - motion.pose[of].rho[i];
    own[1 + i] = -motion.pose[of].quat[1 + i];
  }
  fb_mat33_mulT_vec3(loop->child_position, R, y);
  for (int i = 0; i < 3 && loop->child_node; i++) {
    loop->child_position[i] -= model[desc.model[of]].node[1].r[i];
  }
  fb_quat_mul(loop->child_attitude, own, back);
  desc.n_loop++;
}

static int is_wheel(int k)
{
  return desc.model[k] == WHEEL;
}

/* TIP: beside the node there. */
static void build_spring(const tie *from)
{
  fb_spring *const spring = &desc.spring[desc.n_spring];
  for (int side = 0; side < 2; side++) {
    spring->node[side] = from->body[side] >= TIP;
    spring->body[side] = from->body[side] - (spring->node[side] ? TIP : 0);
    random_vector(spring->position[side], 1);
  }
  if (from->pull == MET) {
    memcpy(spring->position[0], desc.joint[spring->body[1]].position, sizeof spring->position[0]);
    memcpy(spring->position[1], desc.joint[spring->body[1]].child_position, sizeof spring->position[1]);
    met = desc.n_spring;
  }
  spring->stiffness = from->pull == MUSCLE ? FB_R(0.0) : FB_R(3.0);
  spring->length = (fb_real)from->length;
  spring->damping = !(from->length > 0)                         ? FB_R(0.0)
                    : hard > 1 && models[which].with & BOUNDING ? FB_R(600.0)
                                                                : FB_R(0.7);
  pulls[desc.n_spring++] = from->pull != IDLE;
}

static void build(const char *name)
{
  unsigned built = 0;
  while (strcmp(models[which].name, name) != 0 && ++which < (int)(sizeof models / sizeof *models)) {
  }
  if (which == (int)(sizeof models / sizeof *models)) {
    fprintf(stderr, "there is no model %s\n", name);
    exit(3);
  }
  alone = models[which].link[0].joint >= ALONE;
  for (int k = 0; k < 5 && (k == 0 || models[which].link[k].joint != ROOT || models[which].link[k].parent < 0); k++) {
    const hang *const link = &models[which].link[k];
    desc.model[desc.n_body] = link->model % GIVEN;
    if (!(built >> desc.model[desc.n_body] & 1u)) {
      built |= 1u << desc.model[desc.n_body];
      build_model(desc.model[desc.n_body]);
    }
    if (!alone) {
      build_joint(&desc.joint[k], link, models[which].turned);
    }
    if (models[which].turned == AHEAD && !alone) {
      build_plain_joint(&desc.joint[k], k);
    }
    desc.n_body++;
  }
  if (alone) {
    return;
  }
  desc.allow_long_step = hard > 1 && models[which].with & BRAKED;
  need(fb_system_init(&mechanism, &work, model, &desc, MODELS), "system");
  for (int l = 0; l < 2 && models[which].loop[l].joint != ROOT; l++) {
    build_loop(&models[which].loop[l]);
  }
  for (int j = 0; j < 4 && (models[which].spring[j].body[0] != 0 || models[which].spring[j].body[1] != 0); j++) {
    build_spring(&models[which].spring[j]);
  }
  need(fb_system_init(&mechanism, &work, model, &desc, MODELS), "system with its loops");
}

#ifdef WRITE
static void write_coordinate(FILE *out, int a)
{
  fprintf(out, "mode %d", a + 1);
}

/* The step of a body, with its declarations; what it says is why not. */
static int write_body(trace_choice what, code_choice own, char text[400])
{
  const fb_body *const body = &model[desc.model[0]];
  const trace_model of = {body, NULL, NULL, sizeof *body, 0, 0, 1};
  double mass[10] = {(double)hub.hub};
  for (int i = 0; i < 9; i++) {
    mass[1 + i] = (double)(i < 3 ? hub.center[i] : hub.inertia[i - 3]);
  }
  if (code_vary_refusal(&own, body, mass[0])) {
    snprintf(text, 400, "%s", code_vary_refusal(&own, body, mass[0]));
    return 1;
  }
  what.vary = own.vary;
  what.hub = own.vary & CODE_HUB ? mass : NULL;
  what.body = NULL;
  own.places = !own.vary ? 0 : own.single ? trace_places_single(&what, &of) : trace_places(&what, &of);
  {
    const code w = code_write_body(stdout, body, &own, "a table", write_coordinate);
    return code_write_steps(&w, what, &of, own.lanes, code_write_all_types, text);
  }
}

static int write_tree(const trace_choice *what, const tree_choice *own, char text[400])
{
  static fb_system_state start;
  const trace_model of = {model, &mechanism, &start, sizeof model[0], sizeof mechanism, sizeof start, MODELS};
  const code w = tree_begin(stdout, &mechanism, model, what->body, own);
  need(fb_system_state_init(&mechanism, model, &start, &work, NULL, NULL), "start");
  tree_write_head(&w, "a table", fb_system_crc(&mechanism, model, MODELS));
  return code_write_steps(&w, *what, &of, own->lanes, tree_write_types, text);
}

int main(int argc, char **argv)
{
  static const char *const names[5] = {"first", "second", "third", "fourth", "fifth"};
  tree_choice own = {.name = "generated"};
  code_choice body = {.name = "generated"};
  trace_choice what = {.name = "generated", .file = "a table", .body = names, .pulls = pulls, .loads = own.loads};
  char text[400] = "";
  int acts = 0, bad;
  for (int k = 0; k < (int)(sizeof models / sizeof *models) && argc == 1; k++) {
    printf("%s\n", models[k].name);
  }
  if (argc == 1) {
    return 0;
  }
  for (int k = 2; k < argc; k++) {
    acts |= strcmp(argv[k], "--loads") == 0;
    body.single = what.single = own.single |= strcmp(argv[k], "--single") == 0;
    body.lanes = own.lanes |= strcmp(argv[k], "--lanes") == 0;
    what.implicit = own.implicit |= strcmp(argv[k], "--sdirk") == 0;
    body.vary |= strcmp(argv[k - 1], "--vary") == 0 ? code_vary_read(argv[k]) : 0;
  }
  hard = what.implicit ? HARD : 1;
  build(argv[1]);
  for (int k = 0; k < desc.n_body; k++) { /* at the tip, of a rigid body at another place */
    if (acts && !is_wheel(k)) {
      node_put(&own.loads[k], 1);
    }
  }
  body.loads = own.loads[0];
  memcpy(own.pulls, pulls, sizeof pulls);
  bad = alone ? write_body(what, body, text) : write_tree(&what, &own, text);
  fputs(text, stderr);
  return bad;
}
#else
/* ---- the generated structs and those of the library, member by member (members.h) */

#define TOLERANCE (FB_SINGLE ? 2e-3 : 1e-11)
#define STEPS (FB_SINGLE ? 300 : 1000)

typedef struct place {
  size_t own, theirs;
  int n, kind, part; /* of which body, or joint of a loop */
} place;

enum { PLACE, ATTITUDE, MOMENTUM, MODE, MODE_MOMENTUM, FRAME, ANGLE, SPUN, WORKED, VALUE, LOST, KINDS, ACTS, MOTORS };
/* ANGLE, SPUN, MOTORS: of rotors; VALUE: prescribed, or where a loop is locked; LOST: by rounding */

typedef struct reference {
  fb_state body;
  fb_system_state tree;
} reference;
typedef struct acts {
  fb_input body;
  fb_system_input tree;
} acts;
typedef struct sight {
  fb_motion body;
  fb_system_motion tree;
} sight;

#define ROW(struct, mine, other, member, kind, part)                                                                  \
  {                                                                                                                   \
    offsetof(struct, mine), offsetof(other, member), (int)(sizeof(((struct *)0)->mine) / sizeof(fb_real)), kind, part \
  }
#include "members.h"
#define COUNT(array) ((int)(sizeof(array) / sizeof *(array)))

#ifdef VARY /* the model that varies; the library's is fb_body_scale's */
static generated_model varied;
#define OF &varied,
#else
#define OF
#endif
#ifdef BASE_IS_PRESCRIBED /* there is no energy */
typedef fb_energy generated_energy;
#define ENERGY(e, state, in) (int)fb_body_energy_eval(body_of(0), e, &theirs.body, NULL)
#define NODE(out, state, motion, body, k) ((void)(body), generated_node_eval(OF out, state, motion, k))
#elif BODIES > 0
#define ENERGY(e, state, in) (int)generated_energy_eval(e, state, in)
#define NODE(out, state, motion, body, k) generated_node_eval(out, state, motion, body, k)
#else
#define ENERGY(e, state, in) ((void)(in), (int)generated_energy_eval(OF e, state))
#define NODE(out, state, motion, body, k) ((void)(body), generated_node_eval(OF out, state, motion, k))
#endif

static reference theirs;
static generated_state own;
static place piece[60];
static int n_piece;
static double difference[KINDS], extreme[KINDS];
static double amount = 1; /* of loads and of motion */

static fb_real *at(void *of, size_t offset)
{
  return (fb_real *)((char *)of + offset);
}

static const fb_body *body_of(int part)
{
  return &model[desc.model[part]];
}

/* Axes of a joint of that mode, a free root has none. */
static int count(int k, fb_axis_mode mode)
{
  const fb_joint *const joint = &mechanism.joint[k];
  int n = 0;
  for (int i = 0; i < joint->n_axis && joint->kind != FB_JOINT_FREE; i++) {
    n += joint->mode[i] == mode;
  }
  return n;
}

static int is_valued(int k, int i)
{
  const fb_joint *const joint = &mechanism.joint[k];
  return i < joint->n_axis && joint->kind != FB_JOINT_SPHERICAL && joint->mode[i] == FB_AXIS_PRESCRIBED;
}

/* The members of the state that this model has: of an axis that is not free the momentum counts for nothing. */
static void place_all(void)
{
  for (int k = 0; k < COUNT(state_places); k++) {
    place p = state_places[k];
    const int bodies = p.part < desc.n_body, mode = p.kind == MODE || p.kind == MODE_MOMENTUM;
    const int axes = p.kind == MOMENTUM && !alone && mechanism.joint[p.part].kind != FB_JOINT_FREE ? p.n : 0;
    p.theirs += p.kind == ANGLE || p.kind == SPUN ? (size_t)body_of(p.part)->n * sizeof(fb_real) : 0;
    p.kind = p.kind == PLACE && !alone && count(p.part, FB_AXIS_PRESCRIBED) > 0 ? VALUE : p.kind;
    for (int i = 0; i < axes; i++) {
      place axis = p;
      axis.n = 1;
      axis.own += (size_t)i * sizeof(fb_real);
      axis.theirs += (size_t)i * sizeof(fb_real);
      if (mechanism.joint[p.part].mode[i] == FB_AXIS_FREE) {
        piece[n_piece++] = axis;
      }
    }
    if (axes == 0 && !(mode && bodies && body_of(p.part)->n == 0)) {
      piece[n_piece++] = p;
    }
  }
}

/* The generated state becomes that of the library. */
static void take_state(void)
{
  for (int k = 0; k < n_piece; k++) {
    memcpy(at(&own, piece[k].own), at(&theirs, piece[k].theirs), (size_t)piece[k].n * sizeof(fb_real));
  }
}

static void compare(void)
{
  for (int k = 0; k < n_piece; k++) {
    const place *const p = &piece[k];
    for (int i = 0; i < p->n; i++) {
      const double x = (double)at(&theirs, p->theirs)[i], apart = (double)at(&own, p->own)[i] - x;
      const double size = fabs(p->kind == ANGLE ? atan2(sin(apart), cos(apart)) : apart);
      difference[p->kind] = size <= difference[p->kind] ? difference[p->kind] : size; /* a NaN, too */
      extreme[p->kind] = fmax(extreme[p->kind], fabs(x));
    }
  }
}

/* ---- steps of both */

static int their_step(reference *x, const acts *start, const acts *middle, const acts *end, fb_real dt)
{
  static fb_rk4_work one;
  if (alone) {
    return (int)fb_rk4_step(body_of(0), &x->body, &one, start ? &start->body : NULL, middle ? &middle->body : NULL,
                            end ? &end->body : NULL, dt);
  }
#ifdef SDIRK
  return (int)fb_system_sdirk_step(&mechanism, model, &x->tree, &work, start ? &start->tree : NULL,
                                   end ? &end->tree : NULL, dt, generated_ITERATIONS);
#else
  return (int)fb_system_rk4_step(&mechanism, model, &x->tree, &work, start ? &start->tree : NULL,
                                 middle ? &middle->tree : NULL, end ? &end->tree : NULL, dt);
#endif
}

static int own_step(generated_state *x, const generated_input *start, const generated_input *middle,
                    const generated_input *end, fb_real dt)
{
#ifdef SDIRK
  (void)middle;
  return (int)generated_step(x, start, end, dt);
#else
  return (int)generated_step(OF x, start, middle, end, dt);
#endif
}

/* What drives the library becomes what drives the step. */
static void give(generated_input *mine, const acts *in)
{
  memset(mine, 0, sizeof *mine);
  for (int k = 0; k < COUNT(input_places); k++) {
    const place *const p = &input_places[k];
    const char *const from = (const char *)in + p->theirs;
    for (int r = 0; r < p->n && p->kind == MOTORS; r++) { /* one of them is zero */
      at(mine, p->own)[r] = ((const fb_rotor_input *)(const void *)from)[r].torque +
                            ((const fb_rotor_input *)(const void *)from)[r].momentum;
    }
    if (p->kind != MOTORS) {
      memcpy(at(mine, p->own), from, (size_t)p->n * sizeof(fb_real));
    }
  }
}

static void act(fb_load *load, int node, double by, double t, int k)
{
  load->node = node;
  load->axes = FB_AXES_BODY;
  for (int i = 0; i < 3; i++) {
    load->force[i] = (fb_real)(by * sin((node ? 9 : 1) * t + i + 2 * k));
    load->torque[i] = (fb_real)(by * cos((node ? 7 : 2) * t + i + k));
  }
}

static void turn_rotors(fb_rotor_input *in, int k, double t)
{
  for (int r = 0; r < body_of(k)->n_rotor; r++) {
    const int given = body_of(k)->rotor[r].given;
    const fb_real motor = (fb_real)(amount * (given ? 2 : 0.5) * sin(2 * t + r + k + 1));
    in[r].torque = given ? FB_R(0.0) : motor;
    in[r].momentum = given ? motor : FB_R(0.0);
  }
}

static void load_body(fb_input *in, double t)
{
  const fb_base base = body_of(0)->base;
  in->n_load = 2;
  act(&in->load[0], 0, base == FB_BASE_PRESCRIBED ? 0 : 20 * amount, t, 0);
  act(&in->load[1], 1, amount, t, 0);
  for (int i = 0; i < 3 && (base == FB_BASE_PINNED || base == FB_BASE_HINGED); i++) {
    in->load[0].force[i] = FB_R(0.0);
  }
  for (int i = 0; i < 3 && base == FB_BASE_PRESCRIBED; i++) {
    in->v[i] = (fb_real)(amount * (0.2 * i + 0.1 * sin(t)));
    in->w[i] = (fb_real)(amount * (0.1 * i + 0.3 * sin(0.5 * t)));
    in->v_dot[i] = (fb_real)(amount * 0.1 * cos(t));
    in->w_dot[i] = (fb_real)(amount * 0.15 * cos(0.5 * t));
  }
  turn_rotors(in->rotor, 0, t);
}

/* What is prescribed of joints and loops. */
static void drive(fb_system_input *in, double t)
{
  for (int k = 0; k < desc.n_body + desc.n_loop; k++) {
    for (int i = 0; i < 3 && count(k, FB_AXIS_PRESCRIBED) > 0; i++) {
      const double by = (desc.n_loop > 0 ? 0.1 : 1) * (1 - 0.4 * i); /* that a crank turns */
      if (mechanism.joint[k].mode[i] == FB_AXIS_PRESCRIBED) {
        in->drive[k].value[i] = (fb_real)(by * (0.3 * t + 0.1 * sin(2 * t)));
        in->drive[k].rate[i] = (fb_real)(by * (0.3 + 0.2 * cos(2 * t)));
        in->drive[k].acceleration[i] = (fb_real)(-0.4 * by * sin(2 * t));
      }
    }
  }
}

static void load(acts *all, generated_input *mine, double t)
{
  fb_system_input *const in = &all->tree;
  memset(all, 0, sizeof *all);
  if (alone) {
    load_body(&all->body, t);
    give(mine, all);
    return;
  }
  in->n_load = 2 * desc.n_body;
  for (int k = 0; k < desc.n_body; k++) {
    const double by = is_wheel(k) ? 0.01 : 2.0; /* its spin would bound the step */
    in->load[k].body = in->load[desc.n_body + k].body = k;
    act(&in->load[k].load, 0, by, t, k);
    act(&in->load[desc.n_body + k].load, !is_wheel(k), is_wheel(k) ? 0 : 0.5, t, k);
    turn_rotors(in->rotor[k], k, t);
    for (int i = 0; i < mechanism.joint[k].n_axis && mechanism.joint[k].kind != FB_JOINT_FREE; i++) {
      in->drive[k].torque[i] =
          mechanism.joint[k].mode[i] == FB_AXIS_FREE ? (fb_real)(by * sin(3 * t + i - k)) : FB_R(0.0);
    }
  }
  drive(in, t);
  for (int j = 0; j < desc.n_spring; j++) {
    in->pull[j] = pulls[j] ? (fb_real)(2 * sin(2 * t + 3 * j + 1)) : FB_R(0.0);
  }
  give(mine, all);
}

/* ---- where both start */

static void start_body(double speed)
{
  const fb_body *const body = body_of(0);
  const double by = amount * (body->effects & FB_EFFECT_LARGE_DEFLECTION ? 0.05 : 0.1);
  fb_real v[3] = {0, 0, 0}, w[3] = {0, 0, 0}, q_dot[FB_MAX_MODES] = {0};
  need(fb_state_init(body, &theirs.body), "state");
  for (int i = 0; i < 3; i++) {
    v[i] = body->base == FB_BASE_FREE         ? (fb_real)random_number()
           : body->base == FB_BASE_PRESCRIBED ? (fb_real)(0.2 * i)
                                              : FB_R(0.0);
    w[i] = body->base == FB_BASE_PRESCRIBED        ? (fb_real)(0.1 * i)
           : body->base == FB_BASE_HINGED && i < 2 ? FB_R(0.0)
                                                   : (fb_real)(amount * speed * random_number());
  }
  for (int a = 0; a < body->n; a++) {
    const double most = by * (double)body->deflection_limit / (body->n * fmax((double)body->reach[a], 0.1));
    theirs.body.q[a] = (fb_real)(most * random_number());
    q_dot[a] = (fb_real)(most * random_number());
  }
  for (int r = 0; r < body->n_rotor; r++) {
    theirs.body.pi[body->n + r] = body->rotor[r].given ? FB_R(2.0) : FB_R(0.0);
  }
  need(fb_state_from_velocity(body, &theirs.body, v, w, q_dot), "velocity");
  for (int r = 0; r < body->n_rotor; r++) {
    const fb_real spin = (fb_real)(200 * speed * random_number()), angle = (fb_real)(3 * random_number());
    if (!body->rotor[r].given) {
      need(fb_state_rotor_set(body, &theirs.body, r, spin, angle, NULL), "rotor");
    }
  }
}

static void start(double speed)
{
  static fb_link_motion motion[FB_MAX_BODIES];
  const double close = (desc.n_loop > 0 ? 0.1 : 1) / sqrt(hard); /* where loops are closed; with as much energy */
  memset(motion, 0, sizeof motion);
  memset(&theirs, 0, sizeof theirs);
  for (int k = 0; k < desc.n_body && !alone; k++) {
    const fb_body *const body = body_of(k);
    fb_real turn[3];
    random_vector(turn, close);
    random_vector(motion[k].value, 0.5 * close);
    fb_quat_from_rotvec(motion[k].quat, turn);
    random_vector(motion[k].speed, speed);
    random_vector(motion[k].speed + 3, speed);
    for (int r = 0; r < body->n_rotor; r++) {
      motion[k].rotor_speed[r] = (fb_real)(200 * speed * random_number());
      motion[k].rotor_angle[r] = (fb_real)random_number();
    }
    for (int a = 0; a < body->n; a++) {
      const double most = body->reach[a] > FB_R(0.0) ? (double)body->deflection_limit / (double)body->reach[a] : 100.0;
      motion[k].q[a] = (fb_real)(0.05 / sqrt(hard) * most / body->n * random_number());
      motion[k].q_dot[a] = (fb_real)(0.2 / sqrt(hard) * random_number());
    }
  }
  if (alone) {
    start_body(speed);
  } else {
    need(fb_system_state_init(&mechanism, model, &theirs.tree, &work, motion, NULL), "state");
  }
  for (int k = 0; k < desc.n_body && !alone; k++) {
    for (int i = 0; i < 3 && mechanism.joint[k].kind == FB_JOINT_FREE && mechanism.tied < 2; i++) {
      theirs.tree.link[k].u[i] += (fb_real)(0.1 * (i - 1.5)); /* the whole drifts: as of another observer */
      theirs.tree.link[k].u[i] += models[which].with & ORBIT && i == 1 ? FB_R(7546.05) : FB_R(0.0);
    }
  }
  generated_start(&own);
  take_state();
}

/* The longest step of what moves so, at rest where `in` is NULL. */
static double limit_now(const acts *in)
{
  fb_body_limit one;
  fb_system_limit all;
  if (alone) {
    need(fb_body_limit_eval(body_of(0), &one, &theirs.body, in ? &in->body : NULL), "limit");
    return (double)one.rk4;
  }
  need(fb_system_limit_eval(&mechanism, model, &work, &all, &theirs.tree, in ? &in->tree : NULL), "limit");
#ifdef SDIRK
  return (double)all.sdirk;
#else
  return (double)all.rk4;
#endif
}

/* ---- 1,000 steps; 300 in single precision, in which two orders of one sum drift apart by some 5e-6 of undamped modes a step */

/* The step [s]. */
static fb_real usual(void)
{
  const int large = (body_of(0)->effects & FB_EFFECT_LARGE_DEFLECTION) != 0;
  const double most = alone ? (double)fb_rk4_limit(body_of(0), FB_R(1.0), FB_R(1.0))
                            : (double)fb_system_rk4_limit(&mechanism, model, FB_R(1.0), FB_R(1.0));
#ifdef SDIRK
  (void)large, (void)most;
  return FB_R(0.02);
#else
  return (fb_real)fmin(0.01, (alone && large ? 0.05 : 0.15) * (alone ? fmin(most, limit_now(NULL)) : most));
#endif
}

static double fly(int loaded)
{
  static acts in[3];
  static generated_input mine[3];
  const fb_real whole = usual();
  fb_real dt = whole;
  double worst = 0, t = 0;
  int shorter = 0;
  memset(difference, 0, sizeof difference);
  memset(extreme, 0, sizeof extreme);
  extreme[PLACE] = 1e-3;
  for (int k = 0; k < STEPS; k++) {
    int status, same;
    for (int i = 0; i < 3; i++) {
      load(&in[i], &mine[i], t + 0.5 * i * (double)dt);
    }
    status = loaded ? their_step(&theirs, &in[0], &in[1], &in[2], dt) : their_step(&theirs, NULL, NULL, NULL, dt);
    same = loaded ? own_step(&own, &mine[0], &mine[1], &mine[2], dt) : own_step(&own, NULL, NULL, NULL, dt);
    if (status == (int)FB_ERR_CONVERGENCE && same == status && shorter++ < 200) {
      dt *= FB_R(0.7);
      continue;
    }
    if (status != FB_OK || same != status) {
      printf("step %d: status %d, generated %d\n", k, status, same);
      return 1;
    }
    compare();
    t += (double)dt;
    dt = whole;
  }
  for (int kind = 0; kind < LOST; kind++) {
    const double relative = difference[kind] / (extreme[kind] > 0 ? extreme[kind] : 1);
    worst = relative <= worst ? worst : relative;
    printf(" %.1e", relative);
  }
  printf("\n");
  return worst;
}

/* ---- what is refused */

/* A step of both from the state of the library, whose status is the same, and if that refuses the state is as before.
   strict 0: both refuse or both do not. */
static int alike(const acts *in, const generated_input *mine, fb_real dt, int strict, const char *what)
{
  static reference copy;
  generated_state before, after;
  int status, same, good;
  copy = theirs;
  take_state();
  before = after = own;
  status = their_step(&copy, in, in, in, dt);
  same = own_step(&after, mine, mine, mine, dt);
  good = strict ? status == same : (status == FB_OK) == (same == 0);
  good = good && (same == 0 || memcmp(&before, &after, sizeof after) == 0);
  if (!good) {
    printf("%s: library %d, generated %d\n", what, status, same);
  }
  return good;
}

/* On both sides of the step limit under what acts. */
static int bounded(const acts *in, const generated_input *mine)
{
  const double off = FB_SINGLE ? 1e-2 : 1e-6, limit = limit_now(in);
  return !(limit < 1e3) || (alike(in, mine, (fb_real)((1 - off) * limit), 0, "below the limit") &
                            alike(in, mine, (fb_real)((1 + off) * limit), alone, "beyond the limit"));
}

/* The step limit of a motion, also with actuators, and the limit of rotation in a step. */
static int limits(void)
{
  static acts in;
  static generated_input mine;
  const fb_real dt = FB_R(1e-4);
  int good = 1;
  for (int n = 0; n < 12; n++) { /* of lines the deflection counts */
    start(0.5);
    for (int r = 0; r < body_of(0)->n_rotor && alone; r++) {
      theirs.body.pi[body_of(0)->n + r] *= n % 2 ? FB_R(1e3) : FB_R(1.0); /* it bounds the step by nutation */
    }
    good &= bounded(NULL, NULL);
  }
  memset(&in, 0, sizeof in);
  for (int j = 0; j < desc.n_spring; j++) {
    in.tree.pull[j] = pulls[j] && j != met ? FB_R(30.0) : FB_R(0.0);
  }
  give(&mine, &in);
  start(0.1);
  good &= bounded(&in, &mine);
  for (int power = -2; power < 3; power++) {
    load(&in, &mine, 0);
    for (int i = 0; i < 3; i++) {
      const fb_real much = (fb_real)(pow(3, power) * 20) / (dt * dt);
      in.tree.load[0].load.torque[i] = in.body.load[0].torque[i] = much;
    }
    give(&mine, &in);
    good &= (!alone && mechanism.joint[0].n_axis == 0) || (alone && body_of(0)->base == FB_BASE_PRESCRIBED) ||
            alike(&in, &mine, dt, alone, "a torque that turns it too far");
    load(&in, &mine, 0);
    for (int k = 0; k < desc.n_body; k++) {
      in.tree.drive[k].torque[0] =
          is_wheel(k) ? (fb_real)(pow(3, power) * 0.25) / (dt * dt) : in.tree.drive[k].torque[0];
    }
    give(&mine, &in);
    good &= alike(&in, &mine, dt, 0, "motors that turn wheels too far");
  }
  return good;
}

/* Each number of the state that is none, too large, beyond the range of deflections; and no step, or none that is
   one. */
static int refusals(void)
{
  static acts in;
  static generated_input mine;
  const fb_real poison[] = {(fb_real)NAN, -(fb_real)INFINITY, FB_R(10.0) * FB_HUGE, FB_R(100.0)};
  const fb_real step[] = {FB_R(0.0), FB_R(-1e-4), (fb_real)NAN, (fb_real)INFINITY}, small = FB_R(1e-4);
  int good = own_step(NULL, NULL, NULL, NULL, small) == generated_null;
  start(0.1);
  for (int k = 0; k < 4; k++) {
    good &= alike(NULL, NULL, step[k], 1, "a step that is none");
  }
  for (int k = 0; k < COUNT(input_places); k++) {
    load(&in, &mine, 0);
    if (input_places[k].kind == ACTS &&
        (body_of(0)->n > 0 || !alone || input_places[k].theirs != offsetof(acts, body.v_dot))) { /* of no step limit */
      *at(&in, input_places[k].theirs) = (fb_real)NAN;
      give(&mine, &in);
      good &= alike(&in, &mine, small, alone, "an input that is no number");
    }
  }
  for (int k = 0; k < n_piece; k++) {
    for (int i = 0; i < piece[k].n * 4; i++) {
      fb_real *const x = &at(&theirs, piece[k].theirs)[i / 4], kept = *x;
      char what[60];
      snprintf(what, sizeof what, "number %d of kind %d that is %g", i / 4, piece[k].kind, (double)poison[i % 4]);
      *x = poison[i % 4];
      good &= piece[k].kind == VALUE || piece[k].kind == LOST || (i % 4 == 3 && piece[k].kind != MODE) ||
              alike(NULL, NULL, small, 0, what);
      *x = kept;
    }
  }
  return good;
}

/* Energy and rates near the center have the status of the library. */
static int near_alike(fb_status energy)
{
  generated_energy e;
  int good = ENERGY(&e, &own, NULL) == (int)energy;
#if BODIES == 0
  static fb_state rate;
  generated_state one;
  good &=
      (int)generated_rates_eval(OF & one, &own, NULL) == (int)fb_body_rates_eval(body_of(0), &rate, &theirs.body, NULL);
#endif
  return good;
}

/* From the center of gravity outward, where that moves what flies: a step is refused as too near where the library
   refuses it. */
static int center_refused(void)
{
  int root = alone ? 0 : -1, seen[2] = {0, 0}, good = 1;
  for (int k = 0; k < desc.n_body && !alone && mechanism.tied < 2; k++) {
    root = mechanism.joint[k].kind == FB_JOINT_FREE && body_of(k)->mu > FB_R(0.0) ? k : root;
  }
  if (root < 0 || !(body_of(root)->mu > FB_R(0.0)) || models[which].with & ORBIT) {
    return 1;
  }
  for (int k = 0; k < 40; k++) {
    fb_energy e;
    fb_status status;
    start(0.1);
    for (int i = 0; i < 3; i++) {
      fb_real *const x = alone ? &theirs.body.rho[i] : &theirs.tree.link[root].x[i];
      *x = body_of(root)->center[i] + (fb_real)(0.4 * k * (1 - 0.7 * i));
    }
    good &= alike(NULL, NULL, FB_R(1e-6), 1, "near the center");
    status = alone ? fb_body_energy_eval(body_of(0), &e, &theirs.body, NULL)
                   : fb_system_energy_eval(&mechanism, model, &work, &e, &theirs.tree, NULL);
    good &= near_alike(status);
    seen[status == FB_OK]++;
  }
  return good && seen[0] > 0 && seen[1] > 0;
}

/* A spring whose points meet: without its actuator, its step limit on both sides; with it refused. */
static int meets(void)
{
  static acts in;
  static generated_input mine;
  int good;
  need(fb_system_state_init(&mechanism, model, &theirs.tree, &work, NULL, NULL), "state at zero");
  generated_start(&own);
  good = bounded(NULL, NULL);
  memset(&in, 0, sizeof in);
  in.tree.pull[met] = FB_R(0.1);
  give(&mine, &in);
  return alike(&in, &mine, FB_R(1e-4), 1, "points that meet, pulled") &&
         own_step(&own, &mine, &mine, &mine, FB_R(1e-4)) == generated_range && good;
}

/* A step of both from the same state, value and rate of all prescribed axes at its start, middle (NULL: not told) and
   end. */
static int jump(double x, const double *told[3], double dt, const char *what)
{
  static acts in[3];
  static generated_input mine[3];
  static reference copy;
  int status, same;
  memset(in, 0, sizeof in);
  for (int k = 0; k < desc.n_body + desc.n_loop; k++) {
    for (int i = 0; i < 3; i++) {
      theirs.tree.link[k].x[i] = k < desc.n_body && is_valued(k, i) ? (fb_real)x : theirs.tree.link[k].x[i];
      for (int n = 0; n < 3 && is_valued(k, i); n++) {
        in[n].tree.drive[k].value[i] = told[n] ? (fb_real)told[n][0] : FB_R(0.0);
        in[n].tree.drive[k].rate[i] = told[n] ? (fb_real)told[n][1] : FB_R(0.0);
      }
    }
  }
  for (int n = 0; n < 3; n++) {
    give(&mine[n], &in[n]);
  }
  copy = theirs;
  take_state();
  status = their_step(&copy, &in[0], told[1] ? &in[1] : NULL, &in[2], (fb_real)dt);
  same = own_step(&own, &mine[0], told[1] ? &mine[1] : NULL, &mine[2], (fb_real)dt);
  if (status != same) {
    printf("%s by %g: library %d, generated %d\n", what, told[2][0], status, same);
  }
  return status == same ? status == FB_OK ? 1 : 2 : 0;
}

/* Prescribed values that go with their rates, and that jump: taken and refused as by the library, at the same values.
   */
static int jumps(void)
{
  static const double size[] = {0, 0.5, 0.99, 1.01, 3, 1e6}, a[2] = {0, 1}, still[2] = {0, 0},
                      none[2] = {(double)NAN, 1};
  const double dt = 1e-3;
  int seen[3] = {0}, driven = 0;
  for (int k = 0; k < desc.n_body + desc.n_loop && !alone;
       k++) { /* of loops, one that turns an axis, which may jump as far */
    driven |= (is_valued(k, 0) || is_valued(k, 1)) && (desc.n_loop == 0 || models[which].turned == DOOR);
  }
  start(0.1);
  for (int k = 0; k < 6 && driven; k++) {
    const double far = 2 * size[k] * dt; /* of the most a rate of 1 allows */
    const double b[2] = {0.5 * far, 1}, c[2] = {far, 1}, back[2] = {far, -1};
    seen[jump(0, (const double *[3]){a, b, c}, dt, "in the step")]++;
    seen[jump(0, (const double *[3]){a, NULL, c}, dt, "without a middle")]++;
    seen[jump(0, (const double *[3]){a, c, b}, dt, "in its middle")]++;
    seen[jump(0, (const double *[3]){a, b, back}, dt, "there and back")]++;
    seen[jump(0, (const double *[3]){still, still, c}, dt, "at last")]++;
    for (int turns = 0; turns < 2; turns++) { /* a whole one on, too */
      const double from = 0.1 + (turns ? 6.283185307179586 : far);
      const double first[2] = {from, 1}, then[2] = {from + 0.5 * dt, 1}, last[2] = {from + dt, 1};
      seen[jump(0.1, (const double *[3]){first, then, last}, dt, "from the state")]++;
    }
    seen[jump(0, (const double *[3]){still, still, still}, dt, "at rest")]++;
    seen[jump(0, (const double *[3]){a, none, a}, dt, "no number")]++;
  }
  return !driven || (seen[0] == 0 && seen[1] > 5 && seen[2] > 5);
}

/* ---- what is seen */

static int is_seen(const fb_real *mine, const fb_real *other, int n, const char *what)
{
  for (int i = 0; i < n; i++) {
    const double size = 1.0 + fabs((double)other[i]);
    if (!(fabs((double)mine[i] - (double)other[i]) <= TOLERANCE * size)) {
      printf("%s[%d]: %.17g, by the library %.17g\n", what, i, (double)mine[i], (double)other[i]);
      return 0;
    }
  }
  return 1;
}

static int nodes_seen(const sight *motion, const generated_motion *mine)
{
  fb_node_motion node;
  generated_node one;
  fb_real R[9], own_R[9];
  int good = 1;
  for (int k = 0; k < desc.n_body; k++) {
    const fb_body *const body = body_of(k);
    for (int n = 0; n < body->n_node; n++) {
      need(alone ? fb_body_node_motion_eval(body, &node, &theirs.body, &motion->body, n)
                 : fb_body_node_motion_eval(body, &node, &motion->tree.pose[k], &motion->tree.motion[k], n),
           "node");
      good &= NODE(&one, &own, mine, k, n) == generated_ok;
      fb_quat_to_mat33(R, node.quat);
      fb_quat_to_mat33(own_R, one.quat);
      good &= is_seen(one.position, node.position, 3, "node position") && is_seen(own_R, R, 9, "node attitude") &&
              is_seen(one.velocity, node.velocity, 3, "node velocity") &&
              is_seen(one.angular_rate, node.angular_rate, 3, "node angular rate");
    }
    good &=
        NODE(&one, &own, mine, k, body->n_node) == generated_value && NODE(&one, &own, mine, k, -1) == generated_value;
  }
  good &= alone || (NODE(&one, &own, mine, desc.n_body, 0) == generated_value &&
                    NODE(&one, &own, mine, -1, 0) == generated_value);
  return good && NODE(NULL, &own, mine, 0, 0) == generated_null && NODE(&one, NULL, mine, 0, 0) == generated_null &&
         NODE(&one, &own, NULL, 0, 0) == generated_null;
}

static int energy_seen(const acts *in, const generated_input *mine)
{
  fb_energy e;
  generated_energy one;
  fb_real a[3], b[3], size;
  fb_input given = in->body;
  for (int r = 0; r < body_of(0)->n_rotor && alone; r++) { /* of the generated one in the state */
    given.rotor[r].momentum = body_of(0)->rotor[r].given ? theirs.body.pi[body_of(0)->n + r] : FB_R(0.0);
  }
  need(alone ? fb_body_energy_eval(body_of(0), &e, &theirs.body, &given)
             : fb_system_energy_eval(&mechanism, model, &work, &e, &theirs.tree, &in->tree),
       "energy");
  if (alone && body_of(0)->base == FB_BASE_PRESCRIBED) {
    return 1;
  }
  if (ENERGY(NULL, &own, mine) != generated_null || ENERGY(&one, NULL, mine) != generated_null) {
    printf("energy: a status\n");
    return 0;
  }
  (void)mine;
  if ((int)ENERGY(&one, &own, mine) != (int)generated_ok) {
    printf("energy: refused\n");
    return 0;
  }
  size = FB_R(1.0) + e.kinetic + e.strain; /* what rounding is of */
  for (int i = 0; i < 3; i++) {
    a[i] = (i == 0 ? one.kinetic : i == 1 ? one.strain : one.gravity) / size;
    b[i] = (i == 0 ? e.kinetic : i == 1 ? e.strain : e.gravity) / size;
  }
  return is_seen(a, b, 3, "energy");
}

#if BODIES == 0
/* Rates of a body, and a state of none, whose rates, motion and energy are refused. */
static int rates_seen(const acts *in, const generated_input *mine)
{
  static const fb_real none[] = {(fb_real)NAN, -(fb_real)INFINITY, FB_R(10.0) * FB_HUGE};
  static reference rate;
  generated_state one, other_rate, spoiled = own;
  generated_motion motion, other;
  generated_node node;
  generated_energy e;
  int good = fb_body_rates_eval(body_of(0), &rate.body, &theirs.body, &in->body) == FB_OK &&
             generated_motion_eval(OF & motion, &own, mine) == generated_ok &&
             generated_rates_eval(OF & one, &own, mine) == generated_ok;
  for (int k = 0; k < n_piece; k++) {
    for (int i = 0; i < piece[k].n && piece[k].kind < LOST; i++) {
      const fb_real kept = at(&own, piece[k].own)[i];
      good &= is_seen(at(&one, piece[k].own) + i, at(&rate, piece[k].theirs) + i, 1, "a rate");
      for (int j = 0; j < COUNT(none) && piece[k].kind < ANGLE; j++) {
        at(&spoiled, piece[k].own)[i] = none[j];
        good &= generated_rates_eval(OF & other_rate, &spoiled, NULL) == generated_not_finite &&
                generated_motion_eval(OF & other, &spoiled, NULL) == generated_not_finite &&
                NODE(&node, &spoiled, &motion, 0, 0) == generated_not_finite &&
                (body_of(0)->base == FB_BASE_PRESCRIBED || ENERGY(&e, &spoiled, NULL) == generated_not_finite);
      }
      at(&spoiled, piece[k].own)[i] = kept;
    }
  }
  return good;
}
#else
static int rates_seen(const acts *in, const generated_input *mine)
{
  (void)in, (void)mine;
  return 1;
}
#endif

/* Where the bodies and their nodes are, how they move and their energy at the state of the library, under what acts.
   */
static int seen(const acts *in, const generated_input *mine)
{
  static sight motion;
  static generated_motion one;
  fb_real R[9];
  int good = 1;
  take_state();
  need(alone ? fb_body_motion_eval(body_of(0), &motion.body, &theirs.body, &in->body)
             : fb_system_motion_eval(&mechanism, model, &work, &motion.tree, &theirs.tree, &in->tree),
       "motion");
  if (generated_motion_eval(OF & one, &own, mine) != generated_ok ||
      generated_motion_eval(OF NULL, &own, mine) != generated_null ||
      generated_motion_eval(OF & one, NULL, mine) != generated_null) {
    printf("motion: a status\n");
    return 0;
  }
  for (int k = 0; k < COUNT(motion_places); k++) {
    const place *const p = &motion_places[k];
    const fb_real *x = at(&motion, p->theirs);
    if (p->kind == ATTITUDE) {
      fb_quat_to_mat33(R, x);
      x = R;
    }
    good &= is_seen(at(&one, p->own), x, p->n, "motion");
  }
  return nodes_seen(&motion, &one) && energy_seen(in, mine) && rates_seen(in, mine) && good;
}

/* At the end of a flight and at its start, at rest of what is prescribed and under loads. */
static int all_seen(void)
{
  static acts in;
  static generated_input mine;
  int good;
  memset(&in, 0, sizeof in);
  give(&mine, &in);
  good = seen(&in, &mine);
  start(0.3);
  good &= seen(&in, &mine);
  load(&in, &mine, 0.7);
  for (int k = 0; k < desc.n_body && !alone; k++) {
    for (int i = 0; i < 3; i++) { /* where it is */
      in.tree.drive[k].value[i] =
          mechanism.joint[k].mode[i] != FB_AXIS_FREE ? theirs.tree.link[k].x[i] : in.tree.drive[k].value[i];
    }
  }
  give(&mine, &in);
  return seen(&in, &mine) && good;
}

#ifdef VARY
/* Factors that there cannot be are refused, NULL are those of the description; then the model varies as the library's
   does. */
static int vary(void)
{
  static fb_body_work scratch;
  static const fb_real none[] = {FB_R(-1.0), FB_R(1e-7), FB_R(1e7), (fb_real)NAN};
  static const fb_real factor[] = {FB_R(1.3), FB_R(0.6), FB_R(1.7), FB_R(0.8), FB_R(1.2)};
  const size_t damping = offsetof(fb_body_factors, damping);
  static generated_model plain;
  generated_parameters given, other;
  int good = generated_model_init(&plain, NULL) == generated_ok;
  hub.stiffness = hub.damping = hub.mass = hub.hub_mass = hub.hub_inertia = FB_R(1.0);
  for (int k = 0; k < COUNT(parameters_places); k++) {
    const size_t to = parameters_places[k].theirs;
    *at(&given, parameters_places[k].own) = *at(&hub, to) = factor[to / sizeof(fb_real)];
    *at(&other, parameters_places[k].own) = FB_R(1.0);
  }
  good &= generated_model_init(&varied, &other) == generated_ok && memcmp(&varied, &plain, sizeof plain) == 0;
  good &= generated_model_init(NULL, &given) == generated_null;
  for (int k = 0; k < 4 * COUNT(parameters_places); k++) {
    const place *const p = &parameters_places[k / 4];
    other = given;
    *at(&other, p->own) = none[k % 4];
    good &=
        generated_model_init(&varied, &other) == (k % 4 == 1 && p->theirs == damping ? generated_ok : generated_value);
  }
  good &= generated_step(NULL, &own, NULL, NULL, NULL, FB_R(1e-4)) == generated_null;
  need(fb_body_scale(&model[desc.model[0]], &scratch, &model[desc.model[0]], &hub), "factors");
  return generated_model_init(&varied, &given) == generated_ok && good;
}
#endif

/* ---- numbers that are none and flipped bits: a step is refused and nothing changes, or all that it writes is finite */

/* All that a step reads: structs of numbers alone. */
typedef struct subject {
  generated_state state;
  generated_input input[3];
  fb_real dt;
#ifdef VARY
  generated_model model;
#endif
} subject;

#ifndef SAMPLE /* bits that flip */
#define SAMPLE 1000
#endif
enum { WORDS = sizeof(subject) / sizeof(fb_real), RUN = 6 };
static subject calm;
static int n_step, n_refused, n_wrong;

static void wrong(const char *what, int word, double value)
{
  if (n_wrong++ < 20) {
    printf("word %d of %d, %g: %s\n", word, (int)WORDS, value, what);
  }
}

static int is_sound(const void *numbers, size_t size)
{
  for (size_t i = 0; i < size / sizeof(fb_real); i++) {
    fb_real x;
    memcpy(&x, (const char *)numbers + i * sizeof x, sizeof x);
    if (!isfinite(x)) {
      return 0;
    }
  }
  return 1;
}

static int subject_step(subject *s)
{
#ifdef VARY
  varied = s->model;
#endif
  return own_step(&s->state, &s->input[0], &s->input[1], &s->input[2], s->dt);
}

/* With the word zero before and after the step, is all else the same? Then it was neither read nor written. */
static int is_unread(const subject *before, const subject *after, int word)
{
  subject a = *before, b = *after;
  if (word < (int)(sizeof a.state / sizeof(fb_real))) {
    *at(&a, (size_t)word * sizeof(fb_real)) = *at(&b, (size_t)word * sizeof(fb_real)) = FB_R(0.0);
    return subject_step(&a) == FB_OK && is_sound(&a.state, sizeof a.state) && memcmp(&a, &b, sizeof a) == 0;
  }
  return 0;
}

/* What a function was to fill, with 0x5a in it before. */
static void judge_read(int status, const void *out, size_t size, const char *what, int word, double value)
{
  size_t kept = 0;
  while (kept < size && ((const unsigned char *)out)[kept] == 0x5a) {
    kept++;
  }
  if (status == FB_OK ? !is_sound(out, size) : kept < size) {
    wrong(what, word, value);
  }
}

static void judge_reads(const subject *s, int word, double value)
{
  generated_motion motion;
  generated_node node;
  generated_energy energy;
  int status;
#if BODIES == 0
  generated_state rate;
  memset(&rate, 0x5a, sizeof rate);
  status = (int)generated_rates_eval(OF & rate, &s->state, &s->input[0]);
  judge_read(status, &rate, sizeof rate, "rates", word, value);
#endif
  memset(&motion, 0x5a, sizeof motion);
  memset(&energy, 0x5a, sizeof energy);
  status = (int)generated_motion_eval(OF & motion, &s->state, &s->input[0]);
  judge_read(status, &motion, sizeof motion, "motion", word, value);
  for (int k = 0; k < desc.n_body && status == FB_OK; k++) { /* the last one, at the tip */
    memset(&node, 0x5a, sizeof node);
    judge_read((int)NODE(&node, &s->state, &motion, k, body_of(k)->n_node - 1), &node, sizeof node, "node", word,
               value);
  }
#ifndef BASE_IS_PRESCRIBED
  judge_read((int)ENERGY(&energy, &s->state, &s->input[0]), &energy, sizeof energy, "energy", word, value);
#endif
}

#ifdef generated_LANES
#ifdef VARY
static generated_model model_of[generated_LANES];
static generated_lanes_model lanes_model;
#define LANES &lanes_model,
#else
#define LANES
#endif
#ifdef SDIRK /* which is told the start and the end alone */
#define BY(start, middle, end) start, end
#else
#define BY(start, middle, end) start, middle, end
#endif

/* That word in one lane, the calm subject in the others: the bits of single steps. */
static void judge_lanes(const subject *s, int word, double value)
{
  static generated_lanes_state lanes;
  static generated_lanes_input in[3];
  static subject one[generated_LANES];
  generated_status told[generated_LANES];
  for (int k = 0; k < generated_LANES; k++) {
    one[k] = k == word % generated_LANES ? *s : calm;
    one[k].dt = s->dt;
    generated_lanes_put(&lanes, k, &one[k].state);
    for (int i = 0; i < 3; i++) {
      generated_lanes_copy(&in[i], &one[k].input[i], sizeof one[k].input[i], k);
    }
#ifdef VARY
    generated_lanes_put_model(&lanes_model, k, &one[k].model);
#endif
  }
  (void)generated_lanes_step(LANES & lanes, BY(&in[0], &in[1], &in[2]), s->dt, told);
  for (int k = 0; k < generated_LANES; k++) {
    generated_state found;
    generated_lanes_take(&found, &lanes, k);
    if (subject_step(&one[k]) != (int)told[k] || memcmp(&found, &one[k].state, sizeof found) != 0) {
      wrong("a lane is not its single step", word, value);
    }
  }
}
#else
static void judge_lanes(const subject *s, int word, double value)
{
  (void)s, (void)word, (void)value;
}
#endif

/* A word of the calm subject, or of one on its way, becomes `value`; then a run until a step is refused. */
static void judge(const subject *given, int word, fb_real value)
{
  static const int known[] = {FB_OK,       FB_ERR_VALUE, FB_ERR_NOT_FINITE,    FB_ERR_SINGULAR,
                              FB_ERR_STEP, FB_ERR_RANGE, FB_ERR_CONTRADICTION, FB_ERR_CONVERGENCE};
  subject s = *given;
  int status = FB_OK;
  *at(&s, (size_t)word * sizeof value) = value;
  for (int k = 0; k < RUN && status == FB_OK; k++) {
    const subject before = s;
    int found = 0;
    judge_reads(&s, word, (double)value);
    if (k == 0) {
      judge_lanes(&s, word, (double)value);
    }
    status = subject_step(&s);
    n_step++;
    n_refused += status != FB_OK;
    for (int i = 0; i < COUNT(known); i++) {
      found |= known[i] == status;
    }
    if (!found) {
      wrong("no such status", word, (double)value);
    } else if (status != FB_OK && memcmp(&before.state, &s.state, sizeof s.state) != 0) {
      wrong("a refused step changed the state", word, (double)value);
    } else if (status == FB_OK && !is_sound(&s.state, sizeof s.state) && !is_unread(&before, &s, word)) {
      wrong("ok with a state that is not finite", word, (double)value);
    }
  }
}

/* Each word poisoned; bits, one in an odd stride, at the start and in the middle of a run. */
static int hostile(void)
{
  const double largest = FB_SINGLE ? 3.4028234e38 : 1.7976931348623157e308, least = FB_SINGLE ? 1.5e-45 : 5e-324;
  const double poison[] = {(double)NAN, HUGE_VAL, -HUGE_VAL, largest, -largest, 1e18, -1e18,
                           1e9,         -1e9,     least,     0,       -1,       1e30};
  const int bits = WORDS * 8 * (int)sizeof(fb_real), stride = bits > SAMPLE ? (bits / SAMPLE) | 1 : 1;
  subject late;
  start(0.1);
  calm.state = own;
  calm.dt = (fb_real)(0.25 * fmin((double)usual(), limit_now(NULL)));
#ifdef VARY
  calm.model = varied;
#endif
  for (int i = 0; i < 3; i++) {
    static acts in;
    load(&in, &calm.input[i], 0.5 * i * (double)calm.dt);
  }
  late = calm;
  for (int k = 0; k < 2 * RUN; k++) {
    n_wrong += subject_step(&late) != FB_OK;
  }
  for (int word = 0; word < WORDS; word++) {
    for (int k = 0; k < COUNT(poison); k++) {
      judge(&calm, word, (fb_real)poison[k]);
    }
    judge(&calm, word, -*at(&calm, (size_t)word * sizeof(fb_real)));
  }
  for (int bit = 0; bit < bits; bit += stride) {
    const int word = bit / 8 / (int)sizeof(fb_real);
    for (int when = 0; when < 2; when++) {
      subject s = when ? late : calm;
      ((unsigned char *)&s)[bit / 8] = (unsigned char)(((unsigned char *)&s)[bit / 8] ^ (1u << bit % 8));
      judge(when ? &late : &calm, word, *at(&s, (size_t)word * sizeof(fb_real)));
    }
  }
  printf("%d %d\n", n_step, n_refused);
  return n_wrong == 0 && n_refused > 0 && n_refused < n_step;
}

#ifdef generated_LANES
/* ---- lanes: each has the status and the bits of its single step, and one that is refused stays as it was */

static generated_state single[generated_LANES];

/* A number from 0 to 1 by lane, step and place. */
static double number(int a, int b, int c)
{
  const double x = 0.37 * a + 0.71 * b + 0.13 * c;
  return x - floor(x);
}

/* Does what acts stay in a step? What is prescribed has no gaps. */
static int is_held(void)
{
  int n = desc.n_loop;
  for (int k = 0; k < desc.n_body + desc.n_loop && !alone; k++) {
    n += count(k, FB_AXIS_PRESCRIBED);
  }
  return n > 0;
}

/* One step of all, of the first under loads of that size; given 0: under none. *refused: of the first lane; by
   vectors where none is. */
static int lanes_step(int i, int given, double size, fb_real dt, int *refused)
{
  static generated_lanes_state lanes;
  static generated_lanes_input in[2];
  generated_status told[generated_LANES];
  generated_input mine[2][generated_LANES];
#ifdef SDIRK
  const int held = is_held(), first = given;
#else
  const int held = is_held(), first = given && (held || i % 2); /* else nothing acts at the start */
#endif
  int good = 1, any = 0;
  memset(mine, 0, sizeof mine);
  for (int k = 0; k < generated_LANES; k++) {
    for (int n = 0; n < 2; n++) {
      acts all;
      load(&all, &mine[n][k], held ? 0 : 0.01 * (i + n));
      for (int a = 0; a < (int)(sizeof mine[n][k] / sizeof(fb_real)); a++) {
        *at(&mine[n][k], (size_t)a * sizeof(fb_real)) *= (fb_real)(k == 0 ? size : 0.5 + 0.5 * number(k, i, a));
      }
      generated_lanes_copy(&in[n], &mine[n][k], sizeof mine[n][k], k);
    }
    generated_lanes_put(&lanes, k, &single[k]);
#ifdef VARY
    generated_lanes_put_model(&lanes_model, k, &model_of[k]);
#endif
  }
#ifdef generated_WIDE
  static generated_lanes_state copy;
  copy = lanes;
#endif
  (void)generated_lanes_step(LANES & lanes, BY(first ? &in[0] : NULL, first ? &in[0] : NULL, given ? &in[!held] : NULL),
                             dt, told);
  for (int k = 0; k < generated_LANES; k++) {
    generated_state after;
    int one;
#ifdef VARY
    varied = model_of[k];
#endif
    one = own_step(&single[k], first ? &mine[0][k] : NULL, first ? &mine[0][k] : NULL, given ? &mine[!held][k] : NULL,
                   dt);
    generated_lanes_take(&after, &lanes, k);
    good &= one == (int)told[k] && memcmp(&after, &single[k], sizeof after) == 0;
    any |= one;
  }
  *refused = (int)told[0];
#ifdef generated_WIDE
  if (given) {
    const generated_lanes_input *const by[] = {BY(first ? &in[0] : NULL, first ? &in[0] : NULL, &in[!held])};
    good &= (generated_lanes_together(LANES & copy, by, dt) == generated_ok) == !any;
  }
#endif
  if (!good) {
    printf("lanes: step %d, loads %g, dt %g: statuses %d, %d or bits\n", i, size, (double)dt, *refused, any);
  }
  return good;
}

static int lanes_alike(void)
{
  static generated_state kept[generated_LANES];
  generated_status told[generated_LANES];
  fb_real dt;
  int good = 1, status = 0, seen = 0;
  start(0.1);
  dt = (fb_real)(0.2 * fmin((double)usual(), limit_now(NULL)));
  for (int k = 0; k < generated_LANES; k++) {
    start(0.02 * k);
    single[k] = own;
#ifdef VARY
    generated_parameters factors;
    for (int i = 0; i < COUNT(parameters_places); i++) {
      *at(&factors, parameters_places[i].own) = (fb_real)(0.9 + 0.2 * number(k, i, 1));
    }
    good &= generated_model_init(&model_of[k], &factors) == generated_ok;
#endif
  }
  memcpy(kept, single, sizeof kept);
  for (int i = 0; i < 100 && good; i++) {
    good = lanes_step(i, i < 90, 1, dt, &status) && status == 0;
  }
  for (int way = 0; way < 2; way++) { /* longer steps, larger loads, until the
                                         first lane is refused */
    seen = 0;
    for (double by = 1; by < 1e12 && good && seen < 3; by *= 1.5) {
      memcpy(single, kept, sizeof kept);
      good = lanes_step(1, 1, way ? by : 1, way ? dt : (fb_real)by * dt, &status);
      seen += status != 0;
    }
    good = good && (seen > 0 || BODIES == 0);
  }
  for (int k = 0; k < generated_LANES && good; k++) { /* not finite in one of them */
    for (int p = 0; p < n_piece && good; p++) {
      memcpy(single, kept, sizeof kept);
      *at(&single[k], piece[p].own) = (fb_real)NAN;
      good = lanes_step(0, 1, 1, dt, &status);
    }
  }
#if BODIES > 0
  for (int k = 0; k < n_piece * (generated_LANES + 2) && good; k++) { /* nothing acts; a free frame moves in no lane, in
                                                                         one of them, in all */
    const place *const p = &piece[k % n_piece];
    const int moving = k / n_piece;
    memcpy(single, kept, sizeof kept);
    if (p->kind == MOMENTUM && mechanism.joint[p->part].kind == FB_JOINT_FREE) {
      for (int lane = 0; lane < generated_LANES && moving <= generated_LANES; lane++) {
        memset(at(&single[lane], p->own), 0, (size_t)(lane == moving ? 0 : p->n) * sizeof(fb_real));
      }
      good = lanes_step(0, 0, 1, dt, &status);
    }
  }
#endif
  good = good && generated_lanes_step(LANES NULL, BY(NULL, NULL, NULL), dt, told) == generated_null;
  for (int k = 0; k < generated_LANES; k++) {
    good &= told[k] == generated_null;
  }
  memcpy(single, kept, sizeof kept);
  return good && lanes_step(0, 1, 1, 0, &status) && status == (int)generated_value;
}
#else
static int lanes_alike(void)
{
  return 0;
}
#endif

/* In single precision a step turns the attitude of a body onto its angular momentum by what was lost. */
static void turn_onto_momentum(int loaded)
{
#if FB_SINGLE
  if (alone && loaded && body_of(0)->base != FB_BASE_PRESCRIBED) {
    theirs.body.lost_h[0] += FB_R(1e-4) * theirs.body.L[1];
    take_state();
  }
#endif
  (void)loaded;
}

int main(int argc, char **argv)
{
  static const double amounts[] = {1, 1, 1e-9, 1e-7}; /* of a body */
  double worst = 0;
  int good = 1;
#ifdef SDIRK
  hard = HARD;
#endif
  build(argc > 1 ? argv[1] : "");
  place_all();
  good &= FB_SINGLE || generated_crc == (alone ? fb_body_crc(body_of(0)) : fb_system_crc(&mechanism, model, MODELS));
#ifdef VARY
  good &= vary();
#endif
  if (argc > 2) {
    return good && (strcmp(argv[2], "lanes") == 0 ? lanes_alike() : hostile()) ? 0 : 1;
  }
  for (int loaded = 0; loaded < (alone && !FB_SINGLE ? 4 : 2); loaded++) {
    amount = amounts[loaded];
    start(0.3);
    turn_onto_momentum(loaded);
    worst = fmax(worst, fly(loaded));
  }
  amount = 1;
  printf(" worst %.1e\n", worst);
  good &= all_seen();
  good &= refusals();
  good &= limits();
  good &= center_refused();
  good &= jumps();
  good &= met < 0 || meets();
  return good && worst <= TOLERANCE ? 0 : 1;
}
#endif
