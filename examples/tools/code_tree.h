/* code_tree.h - declarations of the step of bodies on joints, whose functions trace/ writes: scene --code, campaign --lanes. */
#ifndef CODE_TREE_H
#define CODE_TREE_H
#include "../common/output.h"
#include "code.h"
#include <math.h>

typedef struct tree_link {
  const fb_body *model;
  const fb_joint *joint;
  int n, axes;      /* modes; scalar or spherical axes */
  int free, driven; /* of the axes; prescribed ones; the others are locked */
} tree_link;

enum { TREE_LANES_ALONE = 2 };

typedef struct tree_choice { /* what is to be written */
  const char *name;
  int single, lanes; /* lanes: 1, or TREE_LANES_ALONE: nothing but them, for a program that loads it, without loads */
  int implicit;      /* 1: the step of SDIRK in place of that of rk4 */
  const fb_system_state *start;        /* where NAME_start puts it, NULL: at zero coordinates, at rest */
  node_set loads[FB_MAX_BODIES];       /* the nodes that have a load, of each body; O says nothing */
  unsigned char pulls[FB_MAX_SPRINGS]; /* 1: the spring between points has an actuator */
  void (*list)(FILE *out, int body);   /* names its nodes and rotors behind it in the head; NULL: without */
} tree_choice;

static struct tree { /* what is written */
  const fb_system *system;
  const char *const *names;
  const tree_choice *choice;
  int n;     /* links */
  int tied;  /* loops tie the free root to the ground: its frame stands still */
  int told;  /* there are prescribed values */
  int works; /* the work of motors and actuators is part of the state */
  double mass;
  tree_link link[FB_MAX_BODIES];
} tree;

/* Axes of a joint of that mode. */
static int tree_count(const fb_joint *joint, fb_axis_mode mode)
{
  int n = 0;
  for (int i = 0; joint->kind != FB_JOINT_FREE && i < joint->n_axis; i++) {
    n += joint->mode[i] == mode;
  }
  return n;
}

static int tree_is_ball(const tree_link *L)
{
  return L->joint->kind == FB_JOINT_SPHERICAL;
}

static int tree_is_root(int k)
{
  return tree.system->joint[k].kind == FB_JOINT_FREE;
}

/* Of the axes of a link, how many places and momenta are in the state: with what is given where others are not. */
static int tree_places_of(const tree_link *L)
{
  return tree_is_ball(L) ? 4 : L->driven == L->axes ? 0 : L->axes;
}

static int tree_momenta_of(const tree_link *L)
{
  return L->free > 0 ? L->axes : 0;
}

/* Have its prescribed axes values? */
static int tree_is_valued(const tree_link *L)
{
  return L->driven > 0 && !tree_is_ball(L);
}

/* Numbers that tell where the joint of a loop is locked. */
static int tree_held(const fb_joint *joint)
{
  return tree_count(joint, FB_AXIS_LOCKED) == 0 ? 0 : joint->kind == FB_JOINT_SPHERICAL ? 4 : joint->n_axis;
}

/* Bodies and, behind them as in fb_system, the joints that close loops. */
static int tree_parts(void)
{
  return tree.n + tree.system->n_loop;
}

static const char *tree_part(int k)
{
  static char name[24];
  snprintf(name, sizeof name, k < tree.n ? "body_%d" : "loop_%d", k < tree.n ? k : k - tree.n);
  return name;
}

/* ---- what acts */

enum { TREE_VALUE = 3, TREE_RATE, TREE_AT_NODES = 6, TREE_INPUTS = TREE_AT_NODES + 2 * FB_MAX_NODES };

static const struct {
  const char *name, *what;
} tree_inputs[TREE_AT_NODES] = {
    {"force", "[N] at O, body axes"},
    {"torque", "[N m]"},
    {"motor", "[N m], [N] of each axis, on the body and back on its parent"},
    {"value", "[rad], [m] of its axis, which is prescribed"},
    {"rate", "[rad/s], [m/s]"},
    {"rotor_motor", "[N m] on each rotor, and back on the body; [N m s] where its momentum is given"}};

/* How many numbers of that kind act on link k, or on the joint of a loop behind them. */
static int tree_input_size(int k, int m)
{
  const tree_link *const L = &tree.link[k < tree.n ? k : 0];
  const fb_joint *const joint = &tree.system->joint[k];
  const int acts = tree.choice->lanes == TREE_LANES_ALONE ? 0 : 3;
  const int driven = tree_count(joint, FB_AXIS_PRESCRIBED) > 0 ? joint->n_axis : 0;
  const int valued = joint->kind == FB_JOINT_SPHERICAL ? 0 : driven;
  const int size[TREE_AT_NODES] = {acts, acts, tree_momenta_of(L), valued, driven, L->model->n_rotor};
  if (m >= TREE_AT_NODES) { /* force and torque of each node but O */
    const int node = (m - TREE_AT_NODES) / 2;
    return k < tree.n && node > 0 && node_is_in(&tree.choice->loads[k], node) ? 3 : 0;
  }
  return k < tree.n || m == TREE_VALUE || m == TREE_RATE ? size[m] : 0;
}

/* The numbers of that kind that act on part k, as a member of a struct. */
static void tree_write_acting(const code *w, int k, int m)
{
  const int torque = (m - TREE_AT_NODES) % 2;
  char name[24], what[32];
  if (m < TREE_AT_NODES) {
    code_member(w, 4, tree_inputs[m].name, tree_input_size(k, m), tree_inputs[m].what);
    return;
  }
  snprintf(name, sizeof name, torque ? "torque_%d" : "force_%d", (m - TREE_AT_NODES) / 2);
  snprintf(what, sizeof what, torque ? "[N m]" : "[N] at node %d, body axes", (m - TREE_AT_NODES) / 2);
  code_member(w, 4, name, tree_input_size(k, m), what);
}

/* What acts on a body or on the joint of a loop. 0: nothing. */
static int tree_write_input_of(const code *w, int k)
{
  int n = 0;
  for (int m = 0; m < TREE_INPUTS; m++) {
    n += tree_input_size(k, m);
  }
  if (n == 0) {
    return 0;
  }
  fputs("  struct {\n", w->out);
  for (int m = 0; m < TREE_INPUTS; m++) {
    tree_write_acting(w, k, m);
  }
  fprintf(w->out, "  } %s;\n", tree_part(k));
  return 1;
}

/* ---- the state */

static const char *const tree_kinds[] = {"free",        "rigid", "revolute",  "prismatic",
                                         "cylindrical", "screw", "universal", "spherical"};

/* A system, and what its state has. */
static void tree_read(const fb_system *system, const fb_body *body, const char *const *names, const tree_choice *choice)
{
  memset(&tree, 0, sizeof tree);
  tree.system = system;
  tree.names = names;
  tree.choice = choice;
  tree.n = system->n_body;
  tree.tied = system->tied == 2;
  for (int k = 0; k < tree.n; k++) {
    tree_link *const L = &tree.link[k];
    L->joint = &system->joint[k];
    L->model = &body[system->model[k]];
    L->n = L->model->n;
    L->axes = tree_is_root(k) ? 0 : L->joint->n_axis;
    L->free = tree_count(L->joint, FB_AXIS_FREE);
    L->driven = tree_count(L->joint, FB_AXIS_PRESCRIBED);
    tree.works |= L->free + L->model->n_rotor > 0;
    tree.mass += (double)L->model->mass;
  }
  for (int k = 0; k < tree_parts(); k++) {
    tree.told |= tree_input_size(k, TREE_VALUE) > 0;
  }
  for (int j = 0; j < system->n_spring; j++) {
    tree.works |= choice->pulls[j] != 0;
  }
}

/* A member, with what rounding takes of it. */
static void tree_kept(const code *w, const char *name, int n)
{
  char lost[24];
  snprintf(lost, sizeof lost, "lost_%s", name);
  code_member(w, 4, name, n, NULL);
  code_member(w, 4, lost, w->single ? n : 0, NULL);
}

/* What of a body changes. */
static void tree_write_body_state(const code *w, int k)
{
  const tree_link *const L = &tree.link[k];
  const int root = tree_is_root(k), ball = root || tree_is_ball(L);
  if (!root && L->axes + L->n + L->model->n_rotor == 0) {
    return;
  }
  fprintf(w->out, "  struct { /* %s, %s */\n", tree.names[k], tree_kinds[(int)L->joint->kind]);
  if (root) {
    code_template(w, "    $ x[3]; /* [m] position of O, inertial axes */\n");
    code_template(w, tree.tied ? "    $ lost_x[3]; /* what it has lost by rounding */\n"
                               : "    $ u[3]; /* [m/s] velocity of the frame that momenta are relative to, inertial "
                                 "axes */\n    $ lost_x[3], lost_u[3];  /* what x and u have lost by rounding */\n");
  }
  if (tree_is_valued(L) && tree_places_of(L) == 0) {
    code_member(w, 4, "x", L->axes, "prescribed, where the last step had it");
  }
  tree_kept(w, ball ? "quat" : "x", root ? 4 : tree_places_of(L));
  tree_kept(w, "p", root ? 6 : tree_momenta_of(L));
  tree_kept(w, "q", L->n);
  tree_kept(w, "pi", L->n);
  tree_kept(w, "rotor_angle", L->model->n_rotor);
  tree_kept(w, "rotor_momentum", L->model->n_rotor);
  fprintf(w->out, "  } body_%d;\n", k);
}

/* State and what acts. */
static void tree_write_types(const code *w)
{
  int n = 0;
  code_template(w, "typedef struct @_state {\n");
  for (int k = 0; k < tree.n; k++) {
    tree_write_body_state(w, k);
  }
  for (int k = tree.n; k < tree_parts(); k++) {
    const int held = tree_held(&tree.system->joint[k]);
    if (held > 0) {
      fputs("  struct {\n", w->out);
      code_member(w, 4, held == 4 ? "hold_quat" : "hold", held, "where its axes are locked");
      fprintf(w->out, "  } %s;\n", tree_part(k));
    }
  }
  code_template(w, tree.works ? "  $ motor_work; /* [J] */\n} @_state;\n\n" : "} @_state;\n\n");
  code_template(w, "typedef struct @_input { /* what acts at one instant; all zero, or NULL: nothing */\n");
  for (int k = 0; k < tree_parts(); k++) {
    n += tree_write_input_of(w, k);
  }
  for (int j = 0; j < tree.system->n_spring; j++) {
    if (tree.choice->pulls[j]) {
      fprintf(w->out, "  %s pull_%d; /* [N] of the actuator of spring %d, which draws its points together */\n",
              code_real(w), j, j);
      n++;
    }
  }
  code_template(w, n > 0 ? "" : "  $ none;\n");
  code_template(w, "} @_input;\n\n");
}

/* Where the bodies are and how they move. */
static inline void tree_write_motion_types(const code *w)
{
  code_template(w, "typedef struct @_motion {\n");
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    fprintf(w->out, "  struct { /* %s */\n", tree.names[k]);
    code_template(w, "    $ position[3], R[9]; /* [m] of O, inertial axes; its axes to the inertial ones, by rows */\n"
                     "    $ v[3], w[3];        /* [m/s] of O, [rad/s], its axes */\n");
    code_member(w, 4, "speed", tree_is_ball(L) ? 0 : L->axes, "of the axes of its joint");
    code_member(w, 4, "q_dot", L->n, "of its modes");
    code_member(w, 4, "rotor_speed", L->model->n_rotor, "[rad/s] relative to their section");
    fprintf(w->out, "  } body_%d;\n", k);
  }
  code_template(w, "} @_motion;\n\n");
  code_template(w, code_node_type);
  code_template(w, code_energy_type);
}

/* ---- what is written of it */

static inline void tree_write_status(const code *w)
{
  code_template(w, "typedef enum @_status { /* values of fb_status */\n"
                   "  @_ok = 0,\n  @_null = -1,        /* a pointer is NULL */\n"
                   "  @_value = -2,       /* dt is not above 0 */\n"
                   "  @_not_finite = -3,  /* not finite, or so large that its square is not */\n"
                   "  @_singular = -5,    /* inertia that is not above zero */\n");
  code_template(w, w->implicit ? "  @_convergence = -6, /* the last correction of a stage is not small: take a shorter "
                                 "step */\n"
                               : "");
  code_template(w, "  @_step_length = -9, /* dt is longer than the stability limit, or a body turns too far in a step "
                   "*/\n");
  code_template(w, tree.told ? "  @_contradiction = -12, /* a prescribed value jumps, or loops cannot be closed */\n"
                   : tree.system->n_loop > 0 ? "  @_contradiction = -12, /* loops cannot be closed */\n"
                                             : "");
  code_template(w,
                "  @_range = -10       /* a deflection is out of range, points of a spring meet, a center is too near "
                "*/\n} @_status;\n\n");
}

/* Comment at the head: what is written, and of what. */
static inline void tree_write_comment(const code *w, const char *source, unsigned crc)
{
  const char *const scheme = w->implicit ? "sdirk" : "rk4";
  fprintf(w->out, "/* %s - made by scene --code from ", w->name);
  output_source(w->out, source);
  fprintf(w->out,
          " with flexbeam %s, %s precision, model 0x%08X: %d\n   bodies on joints and their step of %s: "
          "fb_system_%s_step, traced (%s: tests/reference/THEORY.md).\n"
          "   Include it where needed; one file defines %s_IMPLEMENTATION before. SI units, radians. Mass %.6g kg.",
          FB_VERSION, w->single ? "single" : "double", crc, tree.n, scheme, scheme, w->implicit ? "E11.14" : "E9.15",
          w->name, tree.mass);
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    fprintf(w->out, "\n   body_%d: %s, %d modes, %s", k, tree.names[k], L->n, tree_kinds[(int)L->joint->kind]);
    if (!tree_is_root(k)) {
      fprintf(w->out, " on %s", L->joint->parent < 0 ? "the ground" : tree.names[L->joint->parent]);
    }
    if (tree.choice->list) {
      tree.choice->list(w->out, k);
    }
  }
  fprintf(w->out, " */\n#ifndef %s_CODE\n#define %s_CODE\n#define %s_crc 0x%08Xu\n", w->name, w->name, w->name, crc);
  fputs("#ifdef __cplusplus\nextern \"C\" {\n#endif\n", w->out);
}

static const char *const tree_steps[2] = {
    "/* One step of classical Runge-Kutta, dt [s], under what acts at its start, middle and end. Refused: the state "
    "stays as\n"
    "   it was. */\n"
    "@_status @_step(@_state *state, const @_input *start, const @_input *middle, const @_input *end, $ dt);\n",
    "/* Corrections of a stage, 1 to 8; of the first one more. */\n"
    "#ifndef @_ITERATIONS\n#define @_ITERATIONS 2\n#endif\n"
    "/* One step of SDIRK of order 2, L-stable, dt [s], under what acts at its start and end. Refused: the state stays "
    "as it was. */\n"
    "@_status @_step(@_state *state, const @_input *start, const @_input *end, $ dt);\n"};

static const char tree_reads[] =
    "/* Where the bodies are and how they move at a state, with the rates of prescribed axes (NULL: zero). */\n"
    "@_status @_motion_eval(@_motion *motion, const @_state *state, const @_input *in);\n"
    "/* A node of body_0, body_1, ..: 0 is its O, the others are those of its description in their order. quat may "
    "have either\n   sign. @_value: no such body or node. */\n"
    "@_status @_node_eval(@_node *out, const @_state *state, const @_motion *motion, int body, int node);\n"
    "/* Of all bodies and of the springs and stops of joints, at the same rates. */\n"
    "@_status @_energy_eval(@_energy *energy, const @_state *state, const @_input *in);\n";

/* Numbers of a member at the start; zeros are there already. */
static void tree_write_start_of(const code *w, int k, const char *member, const fb_real *x, int n)
{
  for (int i = 0; i < n; i++) {
    if (fabs((double)x[i]) > 0.0) {
      fprintf(w->out, "  state->%s.%s[%d] = ", tree_part(k), member, i);
      code_number(w, (double)x[i]);
      fputs(";\n", w->out);
    }
  }
}

/* NAME_start. */
static inline void tree_write_start(const code *w)
{
  static const fb_real unit[4] = {FB_R(1.0), 0, 0, 0};
  const fb_system_state *const start = tree.choice->start;
  code_template(w, "\nvoid @_start(@_state *state)\n{\n  memset(state, 0, sizeof *state);\n");
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    const int root = tree_is_root(k), ball = root || tree_is_ball(L);
    const fb_link_state *const x = start ? &start->link[k] : NULL;
    tree_write_start_of(w, k, "quat", x ? x->quat : unit, ball ? 4 : 0);
    if (x) {
      tree_write_start_of(w, k, "x", x->x, root ? 3 : ball ? 0 : L->axes);
      tree_write_start_of(w, k, "u", x->u, root && !tree.tied ? 3 : 0);
      tree_write_start_of(w, k, "lost_x", x->lost_x, root ? 3 : 0);
      tree_write_start_of(w, k, "lost_u", x->lost_u, root && !tree.tied ? 3 : 0);
      tree_write_start_of(w, k, "p", x->p, root ? 6 : tree_momenta_of(L));
      tree_write_start_of(w, k, "q", x->q, L->n);
      tree_write_start_of(w, k, "pi", x->pi, L->n);
      tree_write_start_of(w, k, "rotor_angle", x->q + L->n, L->model->n_rotor);
      tree_write_start_of(w, k, "rotor_momentum", x->pi + L->n, L->model->n_rotor);
    }
  }
  for (int k = tree.n; k < tree_parts(); k++) {
    const int held = tree_held(&tree.system->joint[k]);
    if (held == 4) {
      tree_write_start_of(w, k, "hold_quat", start ? start->hold_quat[k] : unit, 4);
    } else if (start) {
      tree_write_start_of(w, k, "hold", start->hold[k], held);
    }
  }
  fputs("}\n", w->out);
}

/* What is written of a system, as tree_write_types wants it; names: of its bodies. */
static code tree_begin(FILE *out, const fb_system *system, const fb_body *body, const char *const *names,
                       const tree_choice *choice)
{
  const code w = {out, choice->name, choice->single, CODE_ONE, choice->implicit, 0, 0};
  tree_read(system, body, names, choice);
  return w;
}

/* Its declarations, and where its functions begin; crc: the check word of the system. */
static inline void tree_write_head(const code *w, const char *source, unsigned crc)
{
  tree_write_comment(w, source, crc);
  tree_write_status(w);
  code_template(w, "/* All that changes: members of fb_system_state.link[k] in body_k, in the same axes and units; a "
                   "member that the\n   joint or the body does not use is left out. */\n");
  tree_write_types(w);
  tree_write_motion_types(w);
  code_template(w, tree.choice->start ? "/* Where the scene starts. */\n" : "/* At zero coordinates, at rest. */\n");
  code_template(w, "void @_start(@_state *state);\n");
  code_template(w, tree_steps[w->implicit]);
  code_template(w, tree_reads);
  if (tree.choice->lanes) {
    code_write_lanes(w, tree_write_types);
  }
  code_template(w, "#ifdef __cplusplus\n}\n#endif\n#endif\n\n"
                   "#ifdef @_IMPLEMENTATION\n#include <math.h>\n#include <string.h>\n\n");
  tree_write_start(w);
}
#endif
