/* code_tree.h - writes the rk4 step of bodies on joints, a tree with or without loops (code_rows.h), as C99 of its own,
   straight-line: the equations and checks of fb_system_rk4_step, in the words of code.h, which writes what a body has
   by itself; of a tree the step of SDIRK, too (code_sdirk.h). Include flexbeam.h first. The velocities: modes are
   eliminated within their body (E8.11) unless they move a joint (code_node.h), the composite inertia of all that hangs
   on a joint gives the matrix of the speeds of the root and of the joints, factored by L D L^T, constant pivots first:
   for few joints that takes less arithmetic than the articulated inertias of E9.4, since the composite mass of rigid
   bodies stays a number and their first moment a vector. */
#ifndef CODE_TREE_H
#define CODE_TREE_H
#include "code.h"

enum {
  TREE_OWN = 4,
  TREE_ROOT = 7,
  TREE_PUSHED = 9,
  TREE_TRACKED = 6
}; /* of a free root: where h is, numbers at the head, at the tail, behind these where its place is needed */

typedef struct tree_link {
  const fb_body *model;
  const fb_joint *joint;
  int parent, n;    /* link or -1; modes */
  int x, p, q, pi;  /* where its coordinates and momenta are in the vector */
  int angle, spun;  /* those of its rotors */
  int axes, row[3]; /* scalar or spherical axes; rows in the system of equations, given ones behind the others */
  int free, driven; /* of the axes; prescribed ones; the others are locked */
  int moves, open,
      mode_row; /* 1: modes move the node that carries it; it carries such one: row of its modes (code_node.h) */
  code_value D[9], at[3];        /* joint's axes on the parent, its origin there */
  code_value C[9], J[9], s[3];   /* child's axes to the parent's, joint's to the parent's; O from the parent's O */
  code_value A[3][6], A_dot[6];  /* twists */
  code_value I[21], b[6];        /* of all that hangs on the joint: inertia, momentum at rest */
  code_value own[6], V[6], G[6]; /* momentum of the body at rest; velocity; momentum of all that hangs here */
  code_value F[6], g[3], u[6];   /* load of all that hangs here; gravity, body axes; speeds of the axes */
  code_rates rates;
} tree_link;

enum { TREE_LANES_ALONE = 2 };

typedef struct tree_choice { /* what is to be written */
  const char *name;
  int single, lanes; /* lanes: 1, or TREE_LANES_ALONE: nothing but them, for a program that loads it */
  int table;         /* places of a table of the numbers in which systems of this form differ (code_numbers), 0: none */
  const fb_system_state *start;        /* where NAME_start puts it, NULL: at zero coordinates, at rest */
  int implicit;                        /* 1: the step of SDIRK (code_sdirk.h) in place of that of rk4 */
  unsigned loads[FB_MAX_BODIES];       /* bits of the nodes that have a load, of each body; that of O says nothing */
  unsigned char pulls[FB_MAX_SPRINGS]; /* 1: the spring between points has an actuator */
  int traced;                          /* 1: the functions are written by trace/ */
} tree_choice;

static struct tree {
  const fb_system *system;
  const fb_body *body;
  const char *const *names;
  int n, size, root;   /* links; numbers in the vector; the free link, -1: none */
  int always;          /* numbers that change whether or not something pushes: P, L, place, work are behind */
  int work, n_axis;    /* where the work of the motors is, number of axes */
  int n_given, n_open; /* axes that are prescribed or locked; modes of bodies that are open */
  int n_driven;        /* axes that are prescribed */
  int n_valued, flown; /* those that have a value, not of spherical joints; 1: such ones of the free tree */
  int n_rotor;         /* inside bodies */
  int places;          /* of a table of numbers */
  int limited;         /* 1: what is being written tells the step limit */
  const char *spins;   /* the condition on which rotors have their given momenta */
  int implicit, given; /* 1: SDIRK; of that, where the speeds of prescribed axes are in the vector */
  int quiet;           /* 1: motors and prescribed axes are all that acts */
  int stands, pulled;  /* the frame of the free tree stands still (no residual inertia); gravity acts */
  int has_R;           /* the attitude of the root is needed */
  int looped;          /* a free root with loops: its angular momentum is L alone, in inertial axes */
  int placed;          /* the place of O of the root is needed: gravity of a center acts on what flies */
  int tied;            /* loops tie the free root to the ground: its frame stands still, PLACE is where its O is */
  int tracked; /* where O of the root is and how fast its frame are in the vector, at WHERE and FRAME: the place is needed,
                  or springs lead to what does not fly */
  double mass, flying; /* [kg] of all bodies, of the free tree */
  tree_link link[FB_MAX_BODIES];
  const tree_choice *choice;
} tree;

static const char tree_axis[3] = {'x', 'y', 'z'};

static code_value tree_matrix[CODE_ROWS][CODE_ROWS], tree_right[CODE_ROWS];
static int tree_solved[CODE_ROWS]; /* order of elimination of code_solver */

#include "code_rows.h"

/* Of a link: of the node that carries it, where modes move that; of its body, where it is open. */
static struct tree_node {
  rows_end end;
  code_value twist[FB_MAX_MODES][6]; /* Phi, by modes of the parent */
  code_value I[21], rest[6];         /* what hangs on the node, about O of the parent: inertia, momentum at rest */
  code_value passed[6];              /* what last was passed on */
  code_value M_rr[21], spin[6];      /* of an open body; the momenta of its rotors */
} tree_nodes[FB_MAX_BODIES];

/* ---- vectors and matrices of values */

/* A number that is 0 or 1 or -1 but for round-off of `size`. */
static double tree_snap(double x, double size)
{
  const double near = floor(x + 0.5);
  return fabs(x) <= 8.0 * DBL_EPSILON * size ? 0.0 : fabs(x - near) <= 8.0 * DBL_EPSILON ? near : x;
}

static void tree_constants(code_value *x, const fb_real *c, int n)
{
  for (int i = 0; i < n; i++) {
    x[i] = code_constant((double)c[i]);
  }
}

/* s += c (a x b)_i */
static void tree_add_cross(code_sum *s, double c, const code_value a[3], const code_value b[3], int i)
{
  const int y = (i + 1) % 3, z = (i + 2) % 3;
  code_add(s, c, a[y], b[z]);
  code_add(s, -c, a[z], b[y]);
}

/* s += row i of C x (back: of C^T x) */
static void tree_add_turned(code_sum *s, const code_value C[9], int back, const code_value x[3], int i)
{
  for (int j = 0; j < 3; j++) {
    code_add(s, 1.0, C[back ? 3 * j + i : 3 * i + j], x[j]);
  }
}

/* y = C x, or C^T x, by name and link */
static void tree_write_turned(const code *w, code_value y[3], const code_value C[9], int back, const code_value x[3],
                              const char *name, int k)
{
  code_value out[3];
  code_sum s;
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    tree_add_turned(&s, C, back, x, i);
    out[i] = code_end(w, &s, code_variable("b%d_%s_%c", k, name, tree_axis[i]));
  }
  memcpy(y, out, sizeof out);
}

static void tree_nothing(code_value *x, int n)
{
  for (int i = 0; i < n; i++) {
    x[i] = code_constant(0.0);
  }
}

/* y = x + what comes from a child: C x and, of its angular part, s x (C x); by name and child */
static void tree_write_to_parent(const code *w, code_value y[6], const tree_link *L, const code_value x[6],
                                 const char *name, int k)
{
  code_value turned[3];
  code_sum s;
  char word[40];
  snprintf(word, sizeof word, "%sc", name);
  tree_write_turned(w, turned, L->C, 0, x, word, k);
  for (int i = 0; i < 6; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, y[i]);
    if (i < 3) {
      code_add_one(&s, 1.0, turned[i]);
    } else {
      tree_add_turned(&s, L->C, 0, x + 3, i - 3);
      tree_add_cross(&s, 1.0, L->s, turned, i - 3);
    }
    y[i] = code_end(w, &s, code_variable("b%d_%su_%s", k, name, code_rows[i]));
  }
}

/* A vector in the axes of the ground, as link k sees it (back 0: the way back). */
static void tree_write_view(const code *w, code_value y[3], const code_value x[3], const char *name, int k, int back)
{
  int chain[FB_MAX_BODIES], n = 0;
  code_value R[9];
  for (int i = 0; i < 9; i++) {
    R[i] = code_variable("R[%d]", i);
  }
  for (int j = k; j >= 0; j = tree.link[j].parent) {
    chain[n++] = j;
  }
  memcpy(y, x, 3 * sizeof *y);
  for (int i = 0; i < n; i++) {
    const int j = back ? chain[n - 1 - i] : chain[i];
    const tree_link *const L = &tree.link[j];
    char word[40];
    snprintf(word, sizeof word, "%s%d", name, j);
    tree_write_turned(w, y, L->joint->kind == FB_JOINT_FREE ? R : L->C, back, y, word, k);
  }
}

/* A vector in the joint axes of the child, on the spherical joint of link k, in those of the ground. */
static void tree_write_out_of_ball(const code *w, code_value x[3], const char *turned, const char *viewed, int k)
{
  code_value child[9];
  tree_constants(child, tree.link[k].joint->child_axes, 9);
  tree_write_turned(w, x, child, 0, x, turned, k);
  tree_write_view(w, x, x, viewed, k, 0);
}

/* A function of libm and its bracket, of one body or of all lanes. */
static void tree_call(const code *w, const char *name)
{
  if (w->lanes) {
    fprintf(w->out, "%s_wide_%s(", w->name, name);
  } else {
    fprintf(w->out, "%s%s(", name, w->single ? "f" : "");
  }
}

/* ---- what the description is */

static code_rotors tree_rotors[FB_MAX_BODIES];

static int tree_has_gravity(const fb_body *body)
{
#if FB_WITH_GRAVITY
  return (body->effects & FB_EFFECT_GRAVITY) != 0;
#else
  (void)body;
  return 0;
#endif
}

static int large_is(const fb_body *body)
{
  return (body->effects & FB_EFFECT_LARGE_DEFLECTION) != 0;
}

/* Has a body of the system lines? */
static int large_any(const fb_system *system, const fb_body *body)
{
  int any = 0;
  for (int k = 0; k < system->n_body; k++) {
    any |= large_is(&body[system->model[k]]);
  }
  return any;
}

/* Axes of a joint of that mode. */
static int tree_count(const fb_joint *joint, fb_axis_mode mode)
{
  int n = 0;
  for (int i = 0; joint->kind != FB_JOINT_FREE && i < joint->n_axis; i++) {
    n += joint->mode[i] == mode;
  }
  return n;
}

static int tree_is_free(const tree_link *L, int axis)
{
  return L->joint->mode[axis] == FB_AXIS_FREE;
}

static int tree_is_driven(const tree_link *L, int axis)
{
  return L->joint->mode[axis] == FB_AXIS_PRESCRIBED;
}

static int tree_is_ball(const tree_link *L)
{
  return L->joint->kind == FB_JOINT_SPHERICAL;
}

/* Of the axes of a link, how many places and momenta are in the vector: with what is given where others are not. */
/* Does link k fly? The step that is written here has one such link, tree.root. */
static int tree_is_root(int k)
{
  return tree.system->joint[k].kind == FB_JOINT_FREE;
}

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

/* Does link k hang on the free root? */
static int tree_flies(int k)
{
  while (tree.link[k].parent >= 0) {
    k = tree.link[k].parent;
  }
  return k == tree.root;
}

/* A link, and where it is in the vector. */
static void tree_read_link(int k)
{
  tree_link *const L = &tree.link[k];
  L->joint = &tree.system->joint[k];
  L->model = &tree.body[tree.system->model[k]];
  L->parent = L->joint->kind == FB_JOINT_FREE ? -1 : L->joint->parent;
  L->n = L->model->n;
  L->axes = L->joint->kind == FB_JOINT_FREE ? 0 : L->joint->n_axis;
  L->free = tree_count(L->joint, FB_AXIS_FREE);
  L->driven = tree_count(L->joint, FB_AXIS_PRESCRIBED);
  L->moves = L->parent >= 0 && L->joint->moves;
  L->open = L->n > 0 && large_any(tree.system, tree.body);
  if (L->moves) {
    tree.link[L->parent].open = 1;
  }
  L->x = k == tree.root ? 0 : tree.size;
  L->p = L->x + tree_places_of(L);
  tree.size = k == tree.root ? tree.size : L->p + tree_momenta_of(L);
  L->q = tree.size;
  L->pi = L->q + L->n;
  L->angle = L->pi + L->n;
  L->spun = L->angle + L->model->n_rotor;
  tree.size = L->spun + L->model->n_rotor;
  tree.n_rotor += L->model->n_rotor;
}

/* Rows of the system of equations: the root, axes that are free, modes of bodies that are open; what is given. */
static void tree_read_rows(void)
{
  const int root = tree.root >= 0 ? 6 : 0;
  for (int pass = 0; pass < 2; pass++) { /* free axes, others */
    for (int k = 0; k < tree.n; k++) {
      tree_link *const L = &tree.link[k];
      for (int i = 0; i < L->axes; i++) {
        if (tree_is_free(L, i) != pass) {
          L->row[i] = root + tree.n_axis + (pass ? tree.n_open + tree.n_given++ : 0);
          tree.n_axis += !pass;
        }
      }
    }
    for (int k = 0; k < tree.n && !pass; k++) {
      tree.link[k].mode_row = root + tree.n_axis + tree.n_open;
      tree.n_open += tree.link[k].open ? tree.link[k].n : 0;
    }
  }
}

/* What the whole is, by link k. */
static void tree_read_whole(int k)
{
  const tree_link *const L = &tree.link[k];
  const int flies = tree_flies(k);
  tree.n_driven += L->driven;
  tree.n_valued += tree_is_valued(L) ? L->driven : 0;
  tree.flown |= tree_is_valued(L) && flies;
  tree.mass += (double)L->model->mass;
  tree.flying += flies ? (double)L->model->mass : 0.0;
  tree.pulled |= tree_has_gravity(L->model) || code_is_central(L->model);
  tree.placed |= flies && code_is_central(L->model);
  tree.stands |= flies && L->n > 0 && !(L->model->effects & FB_EFFECT_RESIDUAL_INERTIA);
  tree.has_R |= tree_is_ball(L);
}

/* Has spring j between points an actuator? */
static int spans_is_pulled(int j)
{
  return tree.choice->pulls[j];
}

static int spans_are_pulled(const fb_system *system)
{
  int pulled = 0;
  for (int j = 0; j < system->n_spring; j++) {
    pulled |= spans_is_pulled(j);
  }
  return pulled;
}

/* Does body k, -1 the ground, hang on a free root? Of a system that is not read yet. */
static int tree_hangs_free(const fb_system *system, int k)
{
  while (k >= 0 && system->joint[k].kind != FB_JOINT_FREE) {
    k = system->joint[k].parent;
  }
  return k >= 0;
}

/* Does a spring lead from what flies to the ground, or to what hangs on that? */
static int spans_moor(const fb_system *system)
{
  int moored = 0;
  for (int j = 0; j < system->n_spring; j++) {
    const int *const on = system->spring[j].body;
    moored |= tree_hangs_free(system, on[0]) != tree_hangs_free(system, on[1]);
  }
  return moored;
}

/* The tail of the vector, and what it depends on. */
static void tree_read_tail(const fb_system *system, int implicit)
{
  tree.tied = tree.root >= 0 && system->tied == 2;
  tree.tracked = tree.root >= 0 && !tree.tied && (tree.placed || spans_moor(system));
  tree.has_R = (tree.has_R || tree.pulled || implicit || tree.tied || tree.tracked) && tree.root >= 0;
  tree.always = tree.size += tree.size % 2; /* even: loops may take two numbers at once */
  if (tree.root >= 0) {
    tree.link[tree.root].p = tree.size;
    tree.size += TREE_PUSHED + (tree.tracked ? TREE_TRACKED : 0);
  }
  tree.work = tree.n_axis + tree.n_rotor > 0 || spans_are_pulled(system) ? tree.size++ : -1;
  tree.looped = tree.root >= 0 && system->n_loop > 0;
  tree.stands |= tree.tied;
  tree.given = tree.size;
  tree.size += implicit ? tree.n_valued : 0;
}

/* Places of all links in the vector. */
static void tree_read(const fb_system *system, const fb_body *body, const char *const *names, const tree_choice *choice)
{
  const int implicit = choice->implicit;
  memset(&tree, 0, sizeof tree);
  tree.implicit = implicit;
  tree.choice = choice;
  tree.limited = !system->allow_long_step;
  tree.spins = "in";
  tree.system = system;
  tree.body = body;
  tree.names = names;
  tree.n = system->n_body;
  tree.root = -1;
  for (int k = 0; k < tree.n; k++) {
    tree.root = system->joint[k].kind == FB_JOINT_FREE ? k : tree.root;
  }
  tree.size = tree.root >= 0 ? TREE_ROOT : 0;
  for (int k = 0; k < tree.n; k++) {
    tree_read_link(k);
    tree_read_whole(k);
  }
  tree_read_rows();
  rows_read(system, &tree.size);
  tree_read_tail(system, implicit);
}

/* What of a joint is not written, with what would be right; NULL: nothing. */
static const char *tree_joint_refusal(const fb_joint *joint)
{
  const int given = joint->kind == FB_JOINT_FREE && joint->mode[0] != FB_AXIS_FREE;
  return given ? "a free joint that is locked or prescribed: choose mode free, or hang its body on the ground" : NULL;
}

/* Modes of bodies of which a node that they move carries a joint. */
static int tree_open_modes(const fb_system *system, const fb_body *body)
{
  int n = 0;
  for (int k = 0; k < system->n_body; k++) {
    int open = 0;
    for (int c = k + 1; c < system->n_body; c++) {
      open |= system->joint[c].kind != FB_JOINT_FREE && system->joint[c].parent == k && system->joint[c].moves;
    }
    n += (open || large_any(system, body)) * body[system->model[k]].n;
  }
  return n;
}

/* What of a system cannot be written, with the joint or the body; "": nothing. */
static void tree_refusal(char text[200], const fb_system *system, const fb_body *body, const char *const *names)
{
  int roots = 0, axes = 0, modes = 0, given = 0;
  text[0] = '\0';
  for (int k = 0; k < system->n_body && !text[0]; k++) {
    const char *what = code_refusal(&body[system->model[k]]);
    what = what ? what : tree_joint_refusal(&system->joint[k]);
    roots += system->joint[k].kind == FB_JOINT_FREE;
    modes += body[system->model[k]].n;
    axes += system->joint[k].kind == FB_JOINT_FREE ? 0 : system->joint[k].n_axis;
    given += tree_count(&system->joint[k], FB_AXIS_LOCKED) + tree_count(&system->joint[k], FB_AXIS_PRESCRIBED);
    what = what ? what : roots == 2 ? "a second free body: each tree is a file of its own" : NULL;
    if (what) {
      snprintf(text, 200, "%.60s: %s", names[k], what);
    }
  }
  if (!text[0] && axes + tree_open_modes(system, body) > CODE_SPEEDS) {
    snprintf(text, 200, "%d axes of joints%s: choose at most %d", axes + tree_open_modes(system, body),
             tree_open_modes(system, body) > 0 ? " and modes that move a joint" : "", CODE_SPEEDS);
  }
  if (!text[0] && roots + axes - given + modes == 0) {
    snprintf(text, 200, "nothing can move%s: choose a joint with a free axis, or modes", given > 0 ? " by itself" : "");
  }
  if (!text[0] && rows_refusal(system)) {
    snprintf(text, 200, "%s", rows_refusal(system));
  }
}

/* ---- places */

/* The joint's turn T by its coordinates. */
static void tree_write_joint_turn(const code *w, code_value T[9], int k)
{
  const tree_link *const L = &tree.link[k];
  const fbi_joint_traits *const is = fbi_traits(L->joint);
  code_sum s;
  for (int i = 0; i < 9; i++) {
    T[i] = code_constant(i % 4 == 0 ? 1.0 : 0.0);
  }
  if (L->joint->kind == FB_JOINT_SPHERICAL) {
    fprintf(w->out, "  %s T%d[9];\n", code_real(w), k);
    code_template(w, "  @_matrix(");
    fprintf(w->out, "T%d, x + %d);\n", k, L->x);
    for (int i = 0; i < 9; i++) {
      T[i] = code_variable("T%d[%d]", k, i);
    }
  }
  for (int i = 0; i < 2; i++) {
    if (i == is->angle || i == is->tilt) {
      char angle[24];
      if (tree_is_free(L, i)) {
        snprintf(angle, sizeof angle, "x[%d]", L->x + i);
      } else {
        snprintf(angle, sizeof angle, "b%d_x_%d", k, i);
      }
      fprintf(w->out, "  const %s b%d_c%d = ", code_real(w), k, i);
      tree_call(w, "cos");
      fprintf(w->out, "%s);\n  const %s b%d_s%d = ", angle, code_real(w), k, i);
      tree_call(w, "sin");
      fprintf(w->out, "%s);\n", angle);
    }
  }
  if (is->angle >= 0) {
    T[0] = T[4] = code_variable("b%d_c%d", k, is->angle);
    T[3] = T[1] = code_variable("b%d_s%d", k, is->angle);
    T[1].c = -1.0;
  }
  for (int i = 0; i < 3 && is->tilt >= 0; i++) {
    const code_value c = code_variable("b%d_c%d", k, is->tilt), t = code_variable("b%d_s%d", k, is->tilt);
    const code_value y = T[3 * i + 1], z = T[3 * i + 2];
    code_begin(&s);
    code_add(&s, 1.0, c, y);
    code_add(&s, 1.0, t, z);
    T[3 * i + 1] = code_end(w, &s, code_variable("b%d_T_%cy", k, tree_axis[i]));
    code_begin(&s);
    code_add(&s, 1.0, c, z);
    code_add(&s, -1.0, t, y);
    T[3 * i + 2] = code_end(w, &s, code_variable("b%d_T_%cz", k, tree_axis[i]));
  }
}

/* The twist A of the axis a in the child's joint axes (E9.1). */
static void tree_write_twist(const code *w, code_value A[6], const fb_joint *joint, const code_value a[3],
                             const char *name, int k)
{
  code_value axes[9], d[3], turned[3];
  code_sum s;
  for (int i = 0; i < 9; i++) {
    axes[i] = code_constant(tree_snap((double)joint->child_axes[i], 1.0));
    d[i % 3] = code_constant((double)joint->child_position[i % 3]);
  }
  tree_write_turned(w, turned, axes, 0, a, name, k);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    tree_add_cross(&s, 1.0, d, turned, i);
    A[i] = code_end(w, &s, code_variable("b%d_%s_v%c", k, name, tree_axis[i]));
    A[3 + i] = turned[i];
  }
}

static void tree_write_twists(const code *w, int k)
{
  tree_link *const L = &tree.link[k];
  const fbi_joint_traits *const is = fbi_traits(L->joint);
  for (int a = 0; a < L->axes; a++) {
    double size = 0;
    for (int i = 0; i < 6; i++) {
      size = fmax(size, fabs((double)L->joint->A[6 * a + i]));
    }
    for (int i = 0; i < 6; i++) {
      L->A[a][i] = code_constant(tree_snap((double)L->joint->A[6 * a + i], size));
    }
  }
  tree_nothing(L->A_dot, 6);
  if (is->tilt >= 0) {
    const code_value c = code_variable("b%d_c%d", k, is->tilt), s = code_variable("b%d_s%d", k, is->tilt);
    code_value first[3], rate[3];
    first[0] = rate[0] = code_constant(0.0);
    first[1] = rate[2] = s;
    first[2] = rate[1] = c;
    rate[2].c = -1.0;
    tree_write_twist(w, L->A[0], L->joint, first, "A", k);
    tree_write_twist(w, L->A_dot, L->joint, rate, "Ad", k);
  }
}

/* E9.2: C and s of a link. */
static void tree_write_place(const code *w, int k)
{
  tree_link *const L = &tree.link[k];
  const fbi_joint_traits *const is = fbi_traits(L->joint);
  const code_value *const axes = L->D;
  code_value child[9], T[9];
  code_sum s;
  if (L->joint->kind == FB_JOINT_FREE) {
    return;
  }
  tree_constants(child, L->joint->child_axes, 9);
  tree_write_joint_turn(w, T, k);
  for (int i = 0; i < 9; i++) {
    code_begin(&s);
    for (int j = 0; j < 3; j++) {
      code_add(&s, 1.0, axes[i / 3 * 3 + j], T[3 * j + i % 3]);
    }
    L->J[i] = code_end(w, &s, code_variable("b%d_J_%c%c", k, tree_axis[i / 3], tree_axis[i % 3]));
  }
  for (int i = 0; i < 9; i++) {
    code_begin(&s);
    for (int j = 0; j < 3; j++) {
      code_add(&s, 1.0, L->J[i / 3 * 3 + j], child[i % 3 * 3 + j]);
    }
    L->C[i] = code_end(w, &s, code_variable("b%d_C_%c%c", k, tree_axis[i / 3], tree_axis[i % 3]));
  }
  for (int i = 0; i < 3; i++) {
    const int by = is->slide >= 0 ? is->slide : is->pitched ? is->angle : -1;
    code_begin(&s);
    code_add_one(&s, 1.0, L->at[i]);
    if (by >= 0) {
      code_add(&s, is->pitched ? (double)L->joint->pitch : 1.0, axes[3 * i + 2], code_variable("b%d_x_%d", k, by));
    }
    for (int j = 0; j < 3; j++) {
      code_add_one(&s, -(double)L->joint->child_position[j], L->C[3 * i + j]);
    }
    L->s[i] = code_end(w, &s, code_variable("b%d_s_%c", k, tree_axis[i]));
  }
  tree_write_twists(w, k);
}

/* Names of where axes of loops are locked, of the values l_t and rates l_r of those that are prescribed. */
static void rows_write_given_names(const code *w, const char *moves)
{
  for (int r = 0; r < constraint.n; r++) {
    const rows_row *const row = &constraint.row[r];
    const rows_loop *const l = &constraint.loop[row->loop];
    const int j = row->loop, i = row->axis, ball = l->joint->kind == FB_JOINT_SPHERICAL;
    if (i < 0 || (ball && l->joint->mode[i] == FB_AXIS_LOCKED)) {
      continue;
    }
    if (l->joint->mode[i] == FB_AXIS_LOCKED) {
      fprintf(w->out, "  const %s l%d_t_%d = x[%d];\n", code_real(w), j, i, l->hold + i);
      continue;
    }
    for (int rate = ball; rate < 2; rate++) {
      fprintf(w->out, "  const %s l%d_%s_%d = %s ? in->loop_%d.%s[%d] : ", code_real(w), j, rate ? "r" : "t", i,
              rate ? moves : "in", j, rate ? "rate" : "value", i);
      code_template(w, "%z;\n");
    }
  }
}

/* Name of the place of axis a of link k, which is prescribed or locked; seen: at a state s. */
static void tree_write_given_place(const code *w, int k, int a, int seen)
{
  const tree_link *const L = &tree.link[k];
  fprintf(w->out, "  const %s b%d_x_%d = ", code_real(w), k, a);
  if (!tree_is_driven(L, a)) {
    fprintf(w->out, "x[%d];\n", L->x + a);
  } else if (seen) {
    fprintf(w->out, "s->body_%d.x[%d];\n", k, a);
  } else {
    fprintf(w->out, "in ? in->body_%d.value[%d] : ", k, a);
    code_template(w, "%z;\n");
  }
}

/* Names of what is prescribed or locked; moves: the condition on which it has its rate; NULL: at a state s under what acts. */
static void tree_write_given_names(const code *w, const char *moves)
{
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    for (int a = 0; a < L->axes; a++) {
      if (!tree_is_free(L, a) && !tree_is_ball(L)) {
        tree_write_given_place(w, k, a, !moves);
      }
      if (tree_is_driven(L, a)) {
        fprintf(w->out, "  const %s b%d_v_%d = %s ? in->body_%d.rate[%d] : ", code_real(w), k, a, moves ? moves : "in",
                k, a);
        code_template(w, "%z;\n");
      }
    }
  }
  rows_write_given_names(w, moves ? moves : "in");
}

/* Names of what is in the vector. */
static void tree_write_names(const code *w)
{
  const char *const type = code_real(w);
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    for (int i = 0; i < L->axes; i++) {
      if (!tree_is_free(L, i)) {
        continue;
      }
      if (!tree_is_ball(L)) {
        fprintf(w->out, "  const %s b%d_x_%d = x[%d];\n", type, k, i, L->x + i);
      }
      fprintf(w->out, "  const %s b%d_m_%d = x[%d];\n", type, k, i, L->p + i);
    }
    for (int a = 0; a < L->n; a++) {
      fprintf(w->out, "  const %s b%d_q_%d = x[%d];\n", type, k, a, L->q + a);
      fprintf(w->out, "  const %s b%d_p_%d = x[%d];\n", type, k, a, L->pi + a);
    }
  }
}

/* ---- a body by itself, in the words of code.h */

static char tree_prefix[16];

static void large_enter(int k);

/* The body of a link becomes that of code.h; `of` its names. */
static code tree_enter(const code *w, int k)
{
  static const double no_hub[2 * 21]; /* none that varies */
  code own = *w;
  own.n = tree.link[k].n;
  own.large = 0;
  code_read(tree.link[k].model, no_hub);
  code_model.first = 0;
  if (code_model.large) {
    large_enter(k);
  }
  snprintf(tree_prefix, sizeof tree_prefix, "b%d_", k);
  code_of_names = tree_prefix;
  code_now = tree.link[k].rates;
  return own;
}

static void tree_leave(int k)
{
  tree.link[k].rates = code_now;
  code_of_names = "";
}

/* Rotors of a body that is that of code.h, momenta of its modes without those. */
static void tree_write_rotors(const code *own, int k)
{
  char motor[40];
  snprintf(motor, sizeof motor, "body_%d.rotor_motor", k);
  code_write_rotors(own, tree.link[k].spun, tree.spins, motor);
  code_write_own_pi(own, code_now.pi);
  tree_rotors[k] = code_rotor;
}

/* Their momenta, E8.60. */
static void tree_write_spin(const code *own, int k)
{
  code_sum s;
  tree_nothing(tree_nodes[k].spin, 6);
  code_rotor = tree_rotors[k];
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_rotors(&s, 1.0, i);
    tree_nodes[k].spin[3 + i] = code_end(own, &s, code_variable("O_%c", tree_axis[i]));
  }
}

#include "code_large.h"

/* S and momentum at rest, Lambda M^-1 pi, of the body of a link. */
static void tree_write_body(const code *w, int k)
{
  tree_link *const L = &tree.link[k];
  const code own = tree_enter(w, k);
  code_sum s;
  fprintf(w->out, "\n  /* body %d, %s: E8.9, E8.11 */\n", k, tree.names[k]);
  code_write_lambda(&own);
  tree_write_rotors(&own, k);
  code_write_solve(&own, code_now.pb, code_now.pi, "b");
  code_write_inertia(&own);
  for (int e = 0; e < 21 && code_model.constant_S; e++) {
    code_now.S[e] = code_constant(code_whole((double)L->model->S0[e], code_size(L->model, e)));
  }
  for (int i = 0; i < 6; i++) {
    code_begin(&s);
    for (int b = 0; b < L->n; b++) {
      code_add(&s, 1.0, code_now.lambda[i][b], code_now.pb[b]);
    }
    if (i >= 3) { /* E8.60 */
      code_add_rotors(&s, 1.0, i - 3);
    }
    L->own[i] = code_end(&own, &s, code_variable("B_%s", code_rows[i]));
  }
  memcpy(L->I, code_now.S, sizeof L->I);
  memcpy(L->b, L->own, sizeof L->b);
  tree_leave(k);
}

#include "code_impulse.h"
/* ---- inertia of all that hangs on a joint */

/* Is X a multiple of the unit matrix that is a number? */
static int tree_is_round(const code_value X[9])
{
  int round = code_is_constant(&X[0]);
  for (int i = 0; i < 9; i++) {
    round = round && code_is_constant(&X[i]) &&
            (i % 4 == 0 ? fabs(X[i].c - X[0].c) <= 16.0 * DBL_EPSILON * fabs(X[0].c) : code_is_zero(&X[i]));
  }
  return round;
}

/* Is X the matrix of a cross product? */
static int tree_is_cross(const code_value X[9])
{
  int cross = 1;
  for (int i = 0; i < 9; i++) {
    const code_value *const a = &X[i], *const b = &X[i % 3 * 3 + i / 3];
    cross =
        cross && (i % 4 == 0 ? code_is_zero(a)
                             : strcmp(a->name, b->name) == 0 && fabs(a->c + b->c) <= 16.0 * DBL_EPSILON * fabs(a->c));
  }
  return cross;
}

/* Y = C X C^T; symmetric: of X that is. */
static void tree_write_congruent(const code *w, code_value Y[9], const code_value C[9], const code_value X[9],
                                 int symmetric, char name, int k)
{
  code_value T[9];
  code_sum s;
  if (tree_is_round(X)) {
    memcpy(Y, X, 9 * sizeof *Y);
    return;
  }
  if (tree_is_cross(X)) {
    const code_value x[3] = {X[7], X[2], X[3]};
    code_value y[3];
    char word[4] = {name, 'x', '\0', '\0'};
    tree_write_turned(w, y, C, 0, x, word, k);
    for (int i = 0; i < 3; i++) {
      const int j = (i + 1) % 3, l = (i + 2) % 3;
      Y[4 * i] = code_constant(0.0);
      Y[3 * l + j] = Y[3 * j + l] = y[i];
      Y[3 * j + l].c = -y[i].c;
    }
    return;
  }
  for (int i = 0; i < 9; i++) {
    code_begin(&s);
    for (int j = 0; j < 3; j++) {
      code_add(&s, 1.0, C[i / 3 * 3 + j], X[3 * j + i % 3]);
    }
    T[i] = code_end(w, &s, code_variable("b%d_%ct_%c%c", k, name, tree_axis[i / 3], tree_axis[i % 3]));
  }
  for (int i = 0; i < 9; i++) {
    if (symmetric && i % 3 < i / 3) {
      Y[i] = Y[i % 3 * 3 + i / 3];
      continue;
    }
    code_begin(&s);
    for (int j = 0; j < 3; j++) {
      code_add(&s, 1.0, T[i / 3 * 3 + j], C[i % 3 * 3 + j]);
    }
    Y[i] = code_end(w, &s, code_variable("b%d_%c_%c%c", k, name, tree_axis[i / 3], tree_axis[i % 3]));
  }
}

/* Is I that of a rigid body: mass [m 0; 0 m], first moment across? */
static int tree_is_rigid(const code_value I[21])
{
  code_value A[9], B[9];
  for (int i = 0; i < 9; i++) {
    A[i] = I[fb_sym6_index(i / 3, i % 3)];
    B[i] = I[fb_sym6_index(i / 3, 3 + i % 3)];
  }
  return tree_is_round(A) && tree_is_cross(B);
}

/* I of the parent += that of a rigid link (E9.3): with first moment c in the parent's axes J about the new origin is
   J_ii + 2 (s.c - s_i c_i) + m (s.s - s_i s_i), J_ij - s_i c_j - s_j c_i - m s_i s_j, first moment c + m s. */
static void tree_write_rigid(const code *w, int k)
{
  static const int pair[3][2] = {{1, 2}, {2, 0}, {0, 1}};
  const tree_link *const L = &tree.link[k];
  code_value *const I = tree.link[L->parent].I;
  const code_value x[3] = {L->I[fb_sym6_index(2, 4)], L->I[fb_sym6_index(0, 5)], L->I[fb_sym6_index(1, 3)]};
  const double m = L->I[0].c;
  code_value block[9], turned[9], c[3];
  code_sum s;
  for (int i = 0; i < 9; i++) {
    block[i] = L->I[fb_sym6_index(3 + i / 3, 3 + i % 3)];
  }
  tree_write_congruent(w, turned, L->C, block, 1, 'D', k);
  tree_write_turned(w, c, L->C, 0, x, "cC", k); /* minus the first moment */
  for (int i = 0; i < 3; i++) {
    const int y = pair[i][0], z = pair[i][1];
    code_value first;
    code_begin(&s);
    code_add_one(&s, 1.0, I[fb_sym6_index(z, 3 + y)]);
    code_add_one(&s, 1.0, c[i]);
    code_add_one(&s, -m, L->s[i]);
    first = code_end(w, &s, code_variable("b%d_c%d_%c", L->parent, k, tree_axis[i]));
    I[fb_sym6_index(z, 3 + y)] = I[fb_sym6_index(y, 3 + z)] = first;
    I[fb_sym6_index(y, 3 + z)].c = -first.c;
    I[fb_sym6_index(i, i)].c += m;
  }
  for (int e = 15; e < 21; e++) {
    const int i = fbi_sym6_row[e] - 3, j = fbi_sym6_column[e] - 3;
    code_begin(&s);
    code_add_one(&s, 1.0, I[e]);
    code_add_one(&s, 1.0, turned[3 * i + j]);
    for (int l = 0; l < 3 && i == j; l++) {
      if (l != i) {
        code_add(&s, -2.0, L->s[l], c[l]);
        code_add(&s, m, L->s[l], L->s[l]);
      }
    }
    if (i != j) {
      code_add(&s, 1.0, L->s[i], c[j]);
      code_add(&s, 1.0, L->s[j], c[i]);
      code_add(&s, -m, L->s[i], L->s[j]);
    }
    I[e] = code_end(w, &s, code_variable("b%d_I%d_%s_%s", L->parent, k, code_rows[3 + i], code_rows[3 + j]));
  }
}

/* I of the parent += E9.3 of a link. */
static void tree_write_inertia(const code *w, int k)
{
  const tree_link *const L = &tree.link[k];
  tree_link *const P = &tree.link[L->parent];
  code_value block[3][9], turned[3][9], across[9];
  code_sum s;
  if (tree_is_rigid(L->I) && tree_is_rigid(P->I)) {
    tree_write_rigid(w, k);
    return;
  }
  for (int i = 0; i < 9; i++) {
    block[0][i] = L->I[fb_sym6_index(i / 3, i % 3)];
    block[1][i] = L->I[fb_sym6_index(i / 3, 3 + i % 3)];
    block[2][i] = L->I[fb_sym6_index(3 + i / 3, 3 + i % 3)];
  }
  tree_write_congruent(w, turned[0], L->C, block[0], 1, 'A', k);
  tree_write_congruent(w, turned[1], L->C, block[1], 0, 'B', k);
  tree_write_congruent(w, turned[2], L->C, block[2], 1, 'D', k);
  for (int i = 0; i < 9; i++) { /* B - A s^ */
    code_begin(&s);
    code_add_one(&s, 1.0, turned[1][i]);
    tree_add_cross(&s, -1.0, turned[0] + i / 3 * 3, L->s, i % 3);
    across[i] = code_end(w, &s, code_variable("b%d_X_%c%c", k, tree_axis[i / 3], tree_axis[i % 3]));
  }
  for (int e = 0; e < 21; e++) {
    const int i = fbi_sym6_row[e], j = fbi_sym6_column[e];
    code_begin(&s);
    code_add_one(&s, 1.0, P->I[e]);
    if (j < 3) {
      code_add_one(&s, 1.0, turned[0][3 * i + j]);
    } else if (i < 3) {
      code_add_one(&s, 1.0, across[3 * i + j - 3]);
    } else {
      const int r = i - 3, c = j - 3;
      const code_value x[3] = {turned[1][r], turned[1][3 + r], turned[1][6 + r]};
      const code_value y[3] = {across[c], across[3 + c], across[6 + c]};
      code_add_one(&s, 1.0, turned[2][3 * r + c]);
      tree_add_cross(&s, 1.0, L->s, x, c); /* (s^ B)^T */
      tree_add_cross(&s, 1.0, L->s, y, r);
    }
    P->I[e] = code_end(w, &s, code_variable("b%d_I%d_%s_%s", L->parent, k, code_rows[i], code_rows[j]));
  }
}

/* ---- velocities */

/* y = I x of a link */
static void tree_write_momentum(const code *w, code_value y[6], const code_value I[21], const code_value x[6],
                                const code_value *more, const char *name, int k)
{
  code_value out[6];
  code_sum s;
  for (int i = 0; i < 6; i++) {
    code_begin(&s);
    for (int j = 0; j < 6; j++) {
      code_add(&s, 1.0, I[fb_sym6_index(i, j)], x[j]);
    }
    if (more) {
      code_add_one(&s, 1.0, more[i]);
    }
    out[i] = code_end(w, &s, code_variable("b%d_%s_%s", k, name, code_rows[i]));
  }
  memcpy(y, out, sizeof out);
}

static code_value tree_write_along(const code *w, const code_value a[6], const code_value b[6], code_value name)
{
  code_sum s;
  code_begin(&s);
  for (int i = 0; i < 6; i++) {
    code_add(&s, 1.0, a[i], b[i]);
  }
  return code_end(w, &s, name);
}

#include "code_node.h"
#include "code_attract.h"
#include "code_span.h"

/* Elements of the matrix of axis a of link k. */
static void tree_write_column(const code *w, int k, int a)
{
  code_value f[6];
  char word[40];
  snprintf(word, sizeof word, "U%d", a);
  tree_write_momentum(w, f, tree.link[k].I, tree.link[k].A[a], NULL, word, k);
  tree_write_climb(w, k, a + 1, tree.link[k].row[a], f, word);
}

/* The right side: momenta less those at rest. */
static void tree_write_right(const code *w, int k)
{
  const tree_link *const L = &tree.link[k];
  code_value m[3];
  code_sum s;
  if (tree_is_ball(L) && L->free > 0) {
    code_value h[3], child[9];
    tree_constants(child, L->joint->child_axes, 9);
    for (int i = 0; i < 3; i++) {
      m[i] = code_variable("b%d_m_%d", k, i);
    }
    tree_write_view(w, h, m, "h", k, 1);
    tree_write_turned(w, m, child, 1, h, "hj", k);
  }
  for (int i = 0; i < L->axes; i++) {
    if (!tree_is_free(L, i)) {
      continue;
    }
    code_begin(&s);
    code_add_one(&s, 1.0, tree_is_ball(L) ? m[i] : code_variable("b%d_m_%d", k, i));
    for (int j = 0; j < 6; j++) {
      code_add(&s, -1.0, L->A[i][j], L->b[j]);
    }
    tree_right[L->row[i]] = code_end(w, &s, code_variable("y_%d", L->row[i]));
  }
}

/* Angular momentum of the free root, its axes: beside what the step integrates. */
static code_value tree_own(int i)
{
  return tree.looped ? code_variable("own[%d]", i) : code_variable("x[%d]", TREE_OWN + i);
}

static void tree_write_root_right(const code *w)
{
  const tree_link *const L = &tree.link[tree.root];
  code_sum s;
  for (int i = 0; i < 6; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, i < 3 ? code_variable("P[%d]", i) : tree_own(i - 3));
    code_add_one(&s, -1.0, L->b[i]);
    tree_right[i] = code_end(w, &s, code_variable("y_%d", i));
    for (int j = 0; j < 6; j++) {
      tree_matrix[i][j] = L->I[fb_sym6_index(i, j)];
    }
  }
}

/* What prescribed speeds take from the momenta of the n axes that are free. */
static void tree_write_given(const code *w, int n)
{
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    for (int a = 0; a < L->axes; a++) {
      for (int i = 0; i < n && tree_is_driven(L, a); i++) {
        const code_value y = code_variable(a > 0 ? "y_%d_%d_%d" : "y_%d_%d", i, k, a);
        code_sum s;
        code_begin(&s);
        code_add_one(&s, 1.0, tree_right[i]);
        code_add(&s, -1.0, tree_matrix[i][L->row[a]], code_variable("b%d_v_%d", k, a));
        tree_right[i] = code_end(w, &s, y);
      }
      if (!tree_is_free(L, a)) {
        tree_right[L->row[a]] = tree_is_driven(L, a) ? code_variable("b%d_v_%d", k, a) : code_constant(0.0);
      }
    }
  }
}

/* Order of elimination: pivots that are numbers first, then those with few elements beside them. */
static void tree_order(int *order, int n)
{
  static int full[CODE_ROWS][CODE_ROWS], varies[CODE_ROWS][CODE_ROWS];
  int done[CODE_ROWS] = {0};
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) {
      full[i][j] = !code_is_zero(&tree_matrix[i][j]);
      varies[i][j] = !code_is_constant(&tree_matrix[i][j]);
    }
  }
  for (int k = 0; k < n; k++) {
    int best = 0, least = 1 << 30;
    for (int i = 0; i < n; i++) {
      int cost = 100 * varies[i][i];
      for (int j = 0; j < n; j++) {
        cost += full[i][j] && !done[j];
      }
      if (!done[i] && cost < least) {
        best = i;
        least = cost;
      }
    }
    done[best] = 1;
    order[k] = best;
    for (int i = 0; i < n; i++) {
      for (int j = 0; j < n; j++) {
        if (full[best][i] && full[best][j] && !done[i] && !done[j]) {
          full[i][j] = 1;
          varies[i][j] |= varies[best][i] || varies[best][j] || varies[best][best];
        }
      }
    }
  }
}

/* Refusal where a pivot is round-off. */
static void tree_write_pivot_check(const code *w, const code_factor *f)
{
  if (code_write_pivots(w, f, 16.0)) {
    code_template(w, "@_is_finite(x, ");
    fprintf(w->out, "%d) ? ", tree.size);
    code_template(w, "@_range : @_not_finite;\n  }\n");
  }
}

/* L D L^T of the matrix of n axes, in their order; the solution goes to `names`. */
static void tree_write_factors(const code *w, int *order, char names[CODE_ROWS][CODE_NAME], int n)
{
  code_factor *const f = &code_solver;
  tree_order(order, n);
  f->n = n;
  for (int i = 0; i < n; i++) {
    snprintf(f->label[i], sizeof f->label[i], "%d", order[i]);
    snprintf(names[i], CODE_NAME, "u_%d", order[i]);
    f->y[i] = tree_right[order[i]];
    for (int j = 0; j < n; j++) {
      f->S[i][j] = tree_matrix[order[i]][order[j]];
    }
  }
  for (int k = 0; k < n; k++) {
    code_write_pivot(w, f, k);
    code_write_column(w, f, k);
  }
  tree_write_pivot_check(w, f);
}

/* M u = p, and the velocities of all bodies; closes: where the loops of a vector at rest are closed. */
static void tree_write_solve(const code *w, int closes)
{
  static char names[CODE_ROWS][CODE_NAME];
  const int first = tree.root >= 0 ? 6 : 0, n = first + tree.n_axis + tree.n_open;
  code_factor *const f = &code_solver;
  int *const order = tree_solved;
  fputs("\n  /* E9.6: M u = p of the root and the axes of the joints, by L D L^T */\n", w->out);
  for (int i = 0; i < n + tree.n_given; i++) {
    tree_nothing(tree_matrix[i], n + tree.n_given);
  }
  for (int k = 0; k < tree.n; k++) {
    for (int a = 0; a < tree.link[k].axes; a++) {
      tree_write_column(w, k, a);
    }
    tree_write_right(w, k);
    if (tree.link[k].open) {
      code_value p[FB_MAX_MODES];
      for (int a = 0; a < tree.link[k].n; a++) {
        p[a] = tree.link[k].rates.pi[a];
      }
      node_write_modes(w, k);
      node_write_right(w, k, p);
    }
  }
  if (tree.root >= 0) {
    tree_write_root_right(w);
  }
  tree_write_given(w, n);
  tree_write_factors(w, order, names, n);
  for (int j = 0; j < constraint.n_loop; j++) {
    rows_write_frames(w, j);
  }
  if (constraint.n > 0) {
    rows_write_solve(w, f, order, names, closes);
  } else {
    code_write_substitution(w, f, names);
  }
  for (int i = 0; i < n; i++) {
    tree_right[order[i]] = f->x[i];
  }
}

/* Velocities of a link from those of its parent and the speeds of its axes. */
static void tree_write_velocity(const code *w, int k)
{
  tree_link *const L = &tree.link[k];
  code_value at[3], V[6];
  code_sum s;
  for (int i = 0; i < L->axes; i++) {
    L->u[i] = tree_right[L->row[i]];
  }
  for (int a = 0; a < L->n && L->open; a++) {
    L->rates.q_dot[a] = tree_right[L->mode_row + a];
  }
  if (k == tree.root) {
    memcpy(L->V, tree_right, sizeof L->V);
    return;
  }
  tree_nothing(at, 3);
  if (L->parent >= 0) {
    node_write_carried(w, V, k);
  }
  for (int i = 0; i < 3 && L->parent >= 0; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, V[i]);
    tree_add_cross(&s, 1.0, V + 3, L->s, i);
    at[i] = code_end(w, &s, code_variable("b%d_at_%c", k, tree_axis[i]));
  }
  for (int i = 0; i < 6; i++) {
    code_begin(&s);
    if (L->parent >= 0) {
      tree_add_turned(&s, L->C, 1, i < 3 ? at : V + 3, i % 3);
    }
    for (int a = 0; a < L->axes; a++) {
      code_add(&s, 1.0, L->A[a][i], L->u[a]);
    }
    L->V[i] = code_end(w, &s, code_variable("b%d_%s", k, code_rows[i]));
  }
}

/* ---- forces */

static void tree_write_q_dot(const code *w, int k)
{
  tree_link *const L = &tree.link[k];
  if (L->n > 0) {
    const code own = tree_enter(w, k);
    memcpy(code_now.V, L->V, sizeof code_now.V);
    if (!L->open) {
      code_write_q_dot(&own);
    }
    tree_leave(k);
    rows_write_q_dot(w, k);
  }
}

/* pi_dot but for loads that come from outside, and q_dot. */
static void tree_write_modes(const code *w, int k)
{
  static double K[FB_MAX_MODES][FB_MAX_MODES], C[FB_MAX_MODES][FB_MAX_MODES];
  tree_link *const L = &tree.link[k];
  const code own = tree_enter(w, k);
  code_read_springs(K, C, L->model);
  for (int a = 0; a < L->n; a++) {
    code_begin(&code_force[a]);
    for (int b = 0; b < L->n; b++) {
      code_add_one(&code_force[a], -K[a][b], code_q(b));
      code_add_one(&code_force[a], -C[a][b], code_now.q_dot[b]);
    }
    for (int i = 0; i < 3; i++) {
      code_add(&code_force[a], 1.0, code_now.lambda[i][a], L->g[i]);
    }
  }
  code_central = tree_central[k];
  if (code_model.large) {
    large_write_gradient(&own, code_force, k);
  }
  code_write_gradient(&own, code_force);
  code_rotor = tree_rotors[k];
  code_write_rotor_speeds(&own, code_force, L->V, code_now.q_dot);
  code_write_center_rotors(&own, code_force);
  code_write_rotor_rates(&own, L->angle, L->spun);
  tree_rotors[k] = code_rotor;
  tree_leave(k);
  rows_add_modes(w, code_force, k);
  spans_add_modes(code_force, k);
  node_add_modes(w, code_force, k);
  fputs("\n  /* E8.17 */\n", w->out);
  for (int a = 0; a < L->n; a++) {
    char target[32];
    code_sum s;
    snprintf(target, sizeof target, "rate[%d]", L->pi + a);
    code_assign(w, &code_force[a], target);
    if (large_is(L->model)) { /* q_dot is there */
      continue;
    }
    code_begin(&s);
    code_add_one(&s, 1.0, L->rates.q_dot[a]);
    snprintf(target, sizeof target, "rate[%d]", L->q + a);
    code_assign(w, &s, target);
  }
}

/* g and the load by gravity of a body, E8.16. */
static void tree_write_gravity(const code *w, int k)
{
  tree_link *const L = &tree.link[k];
  code_value field[3];
  code_sum s;
  code own;
  tree_nothing(L->F, 6);
  tree_nothing(L->g, 3);
  if (!tree_has_gravity(L->model)) {
    return;
  }
  own = tree_enter(w, k);
  for (int i = 0; i < 3; i++) {
    code_write_value(&own, i);
    field[i] = code_constant(code_gravity(i));
  }
  tree_leave(k);
  tree_write_view(w, L->g, field, "g", k, 1);
  for (int i = 0; i < 3; i++) {
    L->F[i] = L->g[i];
    L->F[i].c *= (double)L->model->mass;
    code_begin(&s);
    tree_add_cross(&s, 1.0, L->rates.value, L->g, i);
    L->F[3 + i] = code_end(w, &s, code_variable("b%d_T_%c", k, tree_axis[i]));
  }
}

/* s += A.(F - turning of G) of axis a, E9.14; and A_dot.G */
static void tree_add_axis(const code *w, code_sum *s, int k, int a)
{
  const tree_link *const L = &tree.link[k];
  for (int i = 0; i < 6; i++) {
    code_sum t;
    code_value load;
    code_begin(&t);
    code_add_one(&t, 1.0, L->F[i]);
    tree_add_cross(&t, -1.0, L->V + 3, L->G + (i < 3 ? 0 : 3), i % 3);
    if (i >= 3) {
      tree_add_cross(&t, -1.0, L->V, L->G, i - 3);
    }
    if (!code_is_zero(&L->A[a][i])) {
      load = code_end(w, &t, code_variable("b%d_N%d_%s", k, a, code_rows[i]));
      code_add(s, 1.0, L->A[a][i], load);
    }
  }
  for (int i = 0; i < 6 && a == 0 && fbi_traits(L->joint)->tilt >= 0; i++) {
    code_value t;
    code_sum one;
    code_begin(&one);
    code_add(&one, 1.0, L->A_dot[i], L->G[i]);
    t = code_end(w, &one, code_variable("b%d_AdG_%s", k, code_rows[i]));
    code_add(s, 1.0, L->u[fbi_traits(L->joint)->tilt], t);
  }
}

static void tree_assign_one(const code *w, code_value x, int at)
{
  char target[32];
  code_sum s;
  code_begin(&s);
  code_add_one(&s, 1.0, x);
  snprintf(target, sizeof target, "rate[%d]", at);
  code_assign(w, &s, target);
}

static const char tree_quat_rate[] = "  #[@0] = `-0.5` * (x[@1] * @x + x[@2] * @y + x[@3] * @z);\n"
                                     "  #[@1] = `0.5` * (x[@0] * @x + x[@2] * @z - x[@3] * @y);\n"
                                     "  #[@2] = `0.5` * (x[@0] * @y + x[@3] * @x - x[@1] * @z);\n"
                                     "  #[@3] = `0.5` * (x[@0] * @z + x[@1] * @y - x[@2] * @x);\n";

/* E4.4: rate of the quaternion at a place of the vector by angular velocity v, own axes; to: where it goes. */
static void tree_write_quat_rate(const code *w, const char *to, int at, const code_value v[3])
{
  char text[1200];
  size_t n = 0;
  for (const char *c = tree_quat_rate; *c; c++) {
    if (*c == '@' && c[1] >= 'x') {
      n += (size_t)snprintf(text + n, sizeof text - n, "%s%s", v[c[1] - 'x'].c < 0.0 ? "-" : "", v[c[1] - 'x'].name);
      c++;
    } else if (*c == '#') {
      n += (size_t)snprintf(text + n, sizeof text - n, "%s", to);
    } else if (*c == '@') {
      n += (size_t)snprintf(text + n, sizeof text - n, "%d", at + c[1] - '0');
      c++;
    } else {
      text[n++] = *c;
    }
  }
  text[n] = '\0';
  code_template(w, text);
}

/* Coordinates and momenta of a spherical joint: E9.14 in inertial axes. */
static void tree_write_ball(const code *w, int k)
{
  const tree_link *const L = &tree.link[k];
  code_value tau[3], body[3], h[3], m[3], child[9], out[3];
  code_sum s;
  if (L->joint->stiffness[0] > FB_R(0.0)) {
    fprintf(w->out, "  %s phi%d[3];\n", code_real(w), k);
    code_template(w, "  @_vector(");
    fprintf(w->out, "phi%d, x + %d);\n", k, L->x);
  }
  for (int a = 0; a < 3; a++) {
    code_begin(&s);
    tree_add_effort(&s, L->joint, a, code_variable("phi%d[%d]", k, a), L->u[a]);
    tree_add_axis(w, &s, k, a);
    tau[a] = code_end(w, &s, code_variable("b%d_tau_%d", k, a));
    m[a] = code_variable("b%d_m_%d", k, a);
  }
  tree_constants(child, L->joint->child_axes, 9);
  tree_write_view(w, h, m, "hb", k, 1);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    tree_add_turned(&s, child, 0, tau, i);
    tree_add_cross(&s, 1.0, L->V + 3, h, i);
    body[i] = code_end(w, &s, code_variable("b%d_turn_%c", k, tree_axis[i]));
  }
  tree_write_view(w, out, body, "w", k, 0);
  for (int i = 0; i < 3; i++) {
    tree_assign_one(w, out[i], L->p + i);
  }
  tree_write_quat_rate(w, "rate", L->x, L->u);
}

/* What of an axis that is prescribed or locked is in the vector stays. */
static void tree_write_still(const code *w, int k, int a)
{
  const tree_link *const L = &tree.link[k];
  if (a < tree_places_of(L)) {
    tree_assign_one(w, code_constant(0.0), L->x + a);
  }
  if (a < tree_momenta_of(L)) {
    tree_assign_one(w, code_constant(0.0), L->p + a);
  }
}

/* A spherical joint that is prescribed or locked. */
static void tree_write_given_ball(const code *w, int k)
{
  const tree_link *const L = &tree.link[k];
  if (L->driven > 0) {
    tree_write_quat_rate(w, "rate", L->x, L->u);
    return;
  }
  for (int i = 0; i < 4; i++) {
    tree_assign_one(w, code_constant(0.0), L->x + i);
  }
}

static void tree_write_axes(const code *w, int k)
{
  const tree_link *const L = &tree.link[k];
  if (tree_is_ball(L)) {
    (L->free > 0 ? tree_write_ball : tree_write_given_ball)(w, k);
    return;
  }
  for (int a = 0; a < L->axes; a++) {
    const code_value x = code_variable("b%d_x_%d", k, a);
    char target[32];
    code_sum s;
    if (!tree_is_free(L, a)) {
      tree_write_still(w, k, a);
      continue;
    }
    code_begin(&s);
    tree_add_effort(&s, L->joint, a, x, L->u[a]);
    tree_add_rubbing(w, &s, L->joint, a, L->u[a], x.name);
    tree_add_axis(w, &s, k, a);
    snprintf(target, sizeof target, "rate[%d]", L->p + a);
    code_assign(w, &s, target);
    tree_assign_one(w, L->u[a], L->x + a);
  }
}

/* ---- loads that come from outside */

/* Does something ask for the load on the whole of a tree: its root, or the stiffening by its acceleration? */
static int tree_needs_load(int k)
{
  double most = 0;
  for (int j = 0; j < tree.n && tree.limited; j++) {
    most = fmax(most, (double)tree.link[j].model->limit_acceleration);
  }
  return tree.link[k].parent < 0 && (k == tree.root || most > 0);
}

#include "code_acts.h"

/* Motors of link k and loads F on all that hangs on it, along its axes: added to its momenta; power to the work. */
static void tree_write_motors(const code *w, int k, const code_value F[6], code_sum *work)
{
  const tree_link *const L = &tree.link[k];
  char target[32];
  code_value tau[3];
  code_sum s;
  for (int a = 0; a < L->axes; a++) {
    if (!tree_is_free(L, a)) {
      continue;
    }
    code_begin(&s);
    code_add_one(&s, 1.0, code_variable("in->body_%d.motor[%d]", k, a));
    for (int i = 0; i < 6; i++) {
      code_add(&s, 1.0, L->A[a][i], F[i]);
    }
    code_add(work, 1.0, code_variable("in->body_%d.motor[%d]", k, a), L->u[a]);
    tau[a] = code_end(w, &s, code_variable("b%d_act_%d", k, a));
  }
  for (int r = 0; r < L->model->n_rotor; r++) {
    if (!L->model->rotor[r].given) {
      code_add(work, 1.0, code_variable("b%d_r%d_motor", k, r), tree_rotors[k].speed[r]);
    }
  }
  if (tree_is_ball(L) && L->free > 0) {
    tree_write_out_of_ball(w, tau, "actb", "actg", k);
  }
  for (int a = 0; a < L->axes; a++) {
    if (tree_is_free(L, a)) {
      code_begin(&s);
      snprintf(target, sizeof target, "rate[%d]", L->p + a);
      code_add_one(&s, 1.0, code_variable("%s", target));
      code_add_one(&s, 1.0, tau[a]);
      code_assign(w, &s, target);
    }
  }
}

/* The load of the caller on the whole of a tree. */
static void tree_add_load(const code *w, int k, const code_value F[6])
{
  char target[48];
  code_sum s;
  for (int i = 0; i < 6 && tree_needs_load(k) && !tree.quiet; i++) {
    code_begin(&s);
    snprintf(target, sizeof target, "load_%d[%d]", k, i);
    code_add_one(&s, 1.0, code_variable("%s", target));
    code_add_one(&s, 1.0, F[i]);
    code_assign(w, &s, target);
  }
}

/* Forces of the caller: E9.15, added to the rates. */
static void tree_write_loads(const code *w)
{
  static code_value F[FB_MAX_BODIES][6];
  code inner = *w;
  code_sum work;
  inner.indent = 4;
  fputs("\n  /* loads of the caller, from the tips; motors */\n  if (in) {\n", w->out);
  code_begin(&work);
  for (int k = 0; k < tree.n; k++) {
    for (int i = 0; i < 6; i++) {
      F[k][i] = tree.quiet ? code_constant(0.0)
                           : code_variable(i < 3 ? "in->body_%d.force[%d]" : "in->body_%d.torque[%d]", k, i % 3);
    }
    acts_write_nodes(&inner, F[k], k);
  }
  for (int k = tree.n - 1; k >= 0; k--) {
    const tree_link *const L = &tree.link[k];
    tree_write_motors(&inner, k, F[k], &work);
    for (int a = 0; a < L->n && !tree.quiet; a++) {
      fprintf(w->out, "    rate[%d] += in->body_%d.modal[%d];\n", L->pi + a, k, a);
    }
    if (L->parent >= 0) {
      tree_write_pass(&inner, F[L->parent], F[k], "l", k);
      node_write_passed(&inner, "rate", 1.0, k);
    } else {
      tree_add_load(&inner, k, F[k]);
    }
  }
  spans_add_power(&work);
  if (tree.work >= 0) {
    char target[32];
    snprintf(target, sizeof target, "rate[%d]", tree.work);
    code_assign(&inner, &work, target);
    fprintf(w->out, "  } else if (pushed) {\n    rate[%d] = ", tree.work);
    code_template(w, "%z;\n");
  }
  fputs("  }\n", w->out);
}

/* Load on each body that hangs on nothing or the ground, without that of the caller. */
static void tree_write_root_loads(const code *w)
{
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    if (tree_needs_load(k)) {
      fprintf(w->out, w->lanes ? "  %s load_%d[6] = {{0}};\n" : "  %s load_%d[6] = {0};\n", code_real(w), k);
    }
    for (int i = 0; i < 6 && tree_needs_load(k); i++) {
      char target[32];
      code_sum s;
      code_begin(&s);
      code_add_one(&s, 1.0, L->F[i]);
      snprintf(target, sizeof target, "load_%d[%d]", k, i);
      if (s.n > 0 || fabs(s.constant) > 0.0) {
        code_assign(w, &s, target);
      }
    }
  }
}

static const char tree_root_pushed[] = "    $ v[3], h_dot[3];\n";

static const char tree_root_turned[] = "    for (int i = 0; i < 3; i++) {\n"
                                       "      const int y = i == 2 ? 0 : i + 1, z = i == 0 ? 2 : i - 1;\n"
                                       "      h_dot[i] = load[3 + i] + P[y] * v[z] - P[z] * v[y];\n";

static const char tree_root_rates[] = "    }\n"
                                      "    @_turn(rate + @_P, x, load);\n"
                                      "    @_turn(rate + @_L, x, h_dot);\n";

static const char tree_root_tracked[] =
    "    @_turn(rate + @_WHERE, x, v);\n"
    "    for (int i = 0; i < 3; i++) {\n"
    "      rate[@_WHERE + i] += x[@_FRAME + i];\n      rate[@_FRAME + i] = %z;\n    }\n";

/* Rates of a free root: E9.14, E11.27. */
static void tree_write_root(const code *w)
{
  const code_value *const V = tree.link[tree.root].V;
  code inner = *w;
  code_value h[3];
  code_sum s;
  inner.indent = 4;
  tree_write_quat_rate(w, "rate", 0, V + 3);
  fputs("\n  /* E9.14, E11.27: angular momentum h of the root in body axes; P, L in inertial axes */\n", w->out);
  for (int i = 0; i < 3; i++) {
    h[i] = tree_own(i);
  }
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    if (!tree.looped) {
      tree_add_cross(&s, 1.0, h, V + 3, i);
    }
    code_assign(w, &s, code_variable("rate[%d]", TREE_OWN + i).name);
  }
  fputs("  if (pushed) {\n", w->out);
  code_template(w, tree_root_pushed);
  fprintf(w->out, "    const %s *const load = load_%d;\n", code_real(w), tree.root);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, V[i]);
    code_assign(&inner, &s, code_variable("v[%d]", i).name);
  }
  code_template(w, tree_root_turned);
  code_template(w, tree.looped ? "" : "      rate[4 + i] += h_dot[i];\n");
  code_template(w, tree_root_rates);
  code_template(w, tree.tracked ? tree_root_tracked : "");
  code_template(w, tree.stands ? "    @_turn(rate + @_PLACE, x, v);\n  }\n"
                               : "    memcpy(rate + @_PLACE, x + @_P, 3 * sizeof *rate);\n  }\n");
}

/* ---- the step limit */

static void tree_write_norm(const code *w, const char *name, int k, const code_value x[3])
{
  code_sum s;
  code_begin(&s);
  for (int i = 0; i < 3; i++) {
    code_add(&s, 1.0, x[i], x[i]);
  }
  fprintf(w->out, "    const %s %s_%d = ", code_real(w), name, k);
  tree_call(w, "sqrt");
  code_settle(&s);
  if (w->lanes && s.n == 0) {
    fprintf(w->out, "%s_wide_all(", w->name);
  }
  code_expression(w, &s, 40);
  fputs(w->lanes && s.n == 0 ? "));\n" : ");\n", w->out);
}

#include "code_limits.h"

/* E11.43: stops of all joints at their present speeds. */
static void tree_write_impacts(const code *w)
{
  char number[40], name[24];
  int n = 0;
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    for (int a = 0; a < L->axes; a++) {
      if (L->joint->mode[a] != FB_AXIS_LOCKED && L->joint->rubs && L->joint->stop_loss[a] > FB_R(0.0)) {
        code_template(w, n++ == 0 ? "    $ hit = %z;\n    const $ " : "    const $ ");
        code_number(number, w, (double)L->joint->stop_loss[a]);
        snprintf(name, sizeof name, "hit_%d", 8 * k + a);
        fprintf(w->out, "%s = %s * ", name, number);
        code_template(w, "fabs~(");
        fprintf(w->out, "%s);\n", L->u[a].name);
        tree_write_larger(w, "hit", "hit", 8 * k + a);
      }
    }
  }
  if (n > 0) {
    code_number(number, w, (double)tree.system->limit_elastic);
    fprintf(w->out, "    stiffening += %s * hit", number);
    code_template(w, " * (`2` + hit);\n");
  }
}

/* E11.43 of loops: stops at their present speeds. */
static void rows_write_impacts(const code *w)
{
  char number[40], name[24];
  int n = 0;
  for (int j = 0; j < constraint.n_loop; j++) {
    const fb_joint *const joint = constraint.loop[j].joint;
    for (int i = 0; i < joint->n_axis; i++) {
      if (joint->mode[i] == FB_AXIS_FREE && joint->stop_loss[i] > FB_R(0.0)) {
        code_template(w, n++ == 0 ? "    $ knock = %z;\n    const $ " : "    const $ ");
        code_number(number, w, (double)joint->stop_loss[i]);
        snprintf(name, sizeof name, "knock_%d", 8 * j + i);
        fprintf(w->out, "%s = %s * ", name, number);
        code_template(w, "fabs~(");
        fprintf(w->out, "l%d_s_%d);\n", j, i);
        tree_write_larger(w, "knock", "knock", 8 * j + i);
      }
    }
  }
  if (n > 0) {
    code_number(number, w, (double)tree.system->limit_loop_elastic);
    fprintf(w->out, "    stiffening += %s * knock", number);
    code_template(w, " * (`2` + knock);\n");
  }
}

/* Of SDIRK: |w| dt <= 1/10, what stiffens, and the springs and dampers of loops and between points, which no iteration
   matrix has. */
static const char *const sdirk_longest[2] = {
    "    bound = g > `10` * fastest ? g : `10` * fastest;\n"
    "    *longest = !(bound >= `0`) ? `0` : bound * @_huge > `1` ? `1` / bound : @_huge;\n  }\n",
    "    bound = @_either(g > `10` * fastest, g, `10` * fastest);\n"
    "    *longest = %Wbound * @_huge > `1`%, `1` / bound%! +\n"
    "               %Fbound * @_huge > `1`%:%Wbound >= `0`%, %z + @_huge%!%;;\n  }\n"};

/* E11.15 of SDIRK, g the largest frequency of what is in no iteration matrix. */
static void sdirk_write_longest(const code *w)
{
  const double elastic = (double)tree.system->limit_loop_elastic, damping = (double)tree.system->limit_loop_damping;
  const char *const damped = tree.system->n_spring > 0 ? " + damped" : "";
  char number[40];
  code_template(w, tree_has_rotors() ? "    fastest += nutation;\n" : "");
  code_number(number, w, elastic);
  code_template(w, "    g = sqrt~(stiffening");
  fprintf(w->out, elastic > 0.0 ? " + %s);\n" : ");\n", number);
  if (damping > 0.0 || damped[0]) {
    code_number(number, w, damping);
    code_template(w, w->lanes ? "    bound = %z + " : "    bound = ");
    fprintf(w->out, "%s%s;\n", number, damped);
    code_template(w, w->lanes ? "    g = @_either(g > bound, g, bound);\n" : "    g = g > bound ? g : bound;\n");
  }
  code_template(w, sdirk_longest[w->lanes != 0]);
}

/* The rotation of a body that counts in the step limit. */
static void tree_write_turning(const code *w, int k)
{
  const int acts = tree_central[k].acts;
  tree_write_norm(w, acts ? "turns" : "spin", k, tree.link[k].V + 3);
  if (acts) {
    code_template(w, "    const $ ");
    fprintf(w->out, "spin_%d = turns_%d + %s;\n", k, k, tree_central[k].rate.name);
  }
}

/* E11.15: the longest stable step at the present motion. */
static void tree_write_limit(const code *w)
{
  code inner = *w;
  char number[40];
  code_sum s;
  inner.indent = 4;
  fputs("\n  /* E8.8, E11.15: longest stable step [s] */\n  if (longest) {\n", w->out);
  code_template(w, "    $ fastest = %z, stiffening = %z, g, bound;\n");
  if (tree_has_rotors()) {
    tree_write_nutation(&inner, &code_solver, tree_solved);
  }
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    tree_write_turning(w, k);
    if (L->parent >= 0) {
      tree_write_norm(w, "arm", k, L->s);
      fprintf(w->out, "    const %s a_%d = a_%d + spin_%d * spin_%d * arm_%d;\n", code_real(w), k, L->parent, L->parent,
              L->parent, k);
    } else {
      code_value load[3];
      for (int i = 0; i < 3; i++) {
        load[i] = tree_needs_load(k) ? code_variable("load_%d[%d]", k, i) : code_constant(0.0);
      }
      tree_write_norm(w, "push", k, load);
      code_number(number, w, L->model->mass > FB_R(0.0) ? 1.0 / (double)L->model->mass : 0.0);
      fprintf(w->out, "    const %s a_%d = %s * push_%d;\n", code_real(w), k, number, k);
    }
    code_begin(&s);
    code_add(&s, (double)L->model->limit_spin, code_variable("spin_%d", k), code_variable("spin_%d", k));
    code_add_one(&s, (double)L->model->limit_acceleration, code_variable("a_%d", k));
    tree_write_larger(w, "fastest", "spin", k);
    if (s.n > 0) {
      char target[48];
      snprintf(target, sizeof target, "stiff_%d", k);
      code_declare(&inner, &s, target);
      tree_write_larger(w, "stiffening", "stiff", k);
    }
  }
  rows_write_impacts(w);
  code_template(w, tree.system->n_spring > 0 ? "    $ damped = %z;\n" : "");
  for (int j = 0; j < tree.system->n_spring; j++) {
    spans_write_bound(&inner, &code_solver, tree_solved, j);
  }
  if (tree.implicit) {
    sdirk_write_longest(w);
    return;
  }
  tree_write_impacts(w);
  large_write_limit(&inner);
  code_number(number, w, 0.5 * ((double)tree.system->limit_damping + (double)tree.system->limit_loop_damping));
  fprintf(w->out, "    g = fastest%s + %s", tree_has_rotors() ? " + nutation" : "", number);
  code_template(w, tree.system->n_spring > 0 ? " + `0.5` * damped;\n" : ";\n");
  code_number(number, w, (double)tree.system->limit_elastic + (double)tree.system->limit_loop_elastic);
  code_template(w, "    bound = g + sqrt~(g * g + ");
  fprintf(w->out, "%s + stiffening);\n", number);
  code_template(w, w->lanes ? "    *longest = %Wbound * @_huge > `2.785`%, `2.785` / bound%! +\n"
                              "               %Fbound * @_huge > `2.785`%:%Wbound >= `0`%, %z + @_huge%!%;;\n  }\n"
                            : "    *longest = !(bound >= `0`) ? `0` : bound * @_huge > `2.785` ? `2.785` / bound : "
                              "@_huge;\n  }\n");
}

/* ---- rates */

static const char tree_rates_head[] =
    "\n/* Rates of the vector x (@_enter) under what acts (NULL: nothing but gravity); w: angular velocities of the "
    "bodies;\n"
    "   longest (NULL: not asked for): stable step; pushed: the tail of the vector, momenta of the root and work, is "
    "not "
    "constant. */\n"
    "static @_NOINLINE @_status @_rates_at(%M$ *rate, $ *w, $ *longest, const $ *x, const @_input *in, int "
    "pushed)\n{\n";

/* Momenta of the root in body axes. */
static void tree_write_pushed(const code *w)
{
  if (tree.looped) {
    code_template(w, "  $ P[3], own[3];\n");
    code_template(w, tree.has_R ? "  $ R[9];\n  @_matrix(R, x);\n" : "");
    code_template(w, "  @_turn_back(P, x, x + @_P);\n  @_turn_back(own, x, x + @_L);\n");
  } else if (tree.root >= 0) {
    code_template(w, "  $ P[3] = {%z, %z, %z};\n");
    code_template(w, tree.has_R ? "  $ R[9];\n  @_matrix(R, x);\n" : "");
    code_template(w, "  if (pushed) {\n    @_turn_back(P, x, x + @_P);\n  }\n");
  } else if (tree.work < 0) {
    fputs("  (void)pushed;\n", w->out);
  }
}

/* Places, velocities and momenta of a vector. */
static void tree_write_velocities(const code *w)
{
  tree_write_names(w);
  code_template(w, constraint.n > 0 ? "  $ Q[@_ROWS * @_ROWS], c[@_ROWS], above[@_ROWS], mu[@_ROWS];\n" : "");
  code_template(w, rows_are_driven() ? "  $ rough[@_ROWS];\n" : "");
  tree_write_pushed(w);
  fputs("\n  /* E9.2: axes C of each body in its parent's, place s of its O there */\n", w->out);
  tree_write_places(w, LARGE_SEEN);
  tree_write_bodies(w);
  large_write_range(w);
  tree_write_inertias(w);
  tree_write_solve(w, 0);
  fputs("\n  /* E9.5: velocities and momenta of the bodies */\n", w->out);
  for (int k = 0; k < tree.n; k++) {
    tree_write_velocity(w, k);
    rows_write_momenta(w, k);
    tree_write_own_momentum(w, k);
    tree_write_gravity(w, k);
  }
  for (int k = 0; k < tree.n; k++) {
    tree_write_q_dot(w, k);
  }
}

/* Rates of a vector, angular velocities of the bodies. */
static void tree_write_evaluation(const code *w)
{
  tree_write_given_names(w, "in");
  tree_write_velocities(w);
  attract_write_bodies(w);
  rows_write_loads(w);
  spans_write_loads(w);
  rows_write_check(w, "");
  for (int k = 0; k < tree.n; k++) {
    if (tree.link[k].n + tree.link[k].model->n_rotor > 0 && !tree.link[k].open) {
      tree_write_modes(w, k);
    }
  }
  fputs("\n  /* E9.14: rates of the momenta of joints, p = A.G */\n", w->out);
  for (int k = tree.n - 1; k >= 0; k--) {
    if (tree.link[k].open) { /* all that hangs on it is known */
      tree_write_modes(w, k);
    }
    if (tree.link[k].parent >= 0) {
      node_write_pass_loads(w, k);
    }
    tree_write_axes(w, k);
  }
  tree_write_root_loads(w);
  tree_write_loads(w);
  if (tree.root >= 0) {
    tree_write_root(w);
  }
  for (int i = 0; i < 3 * tree.n; i++) {
    code_sum s;
    code_begin(&s);
    code_add_one(&s, 1.0, tree.link[i / 3].V[3 + i % 3]);
    code_assign(w, &s, code_variable("w[%d]", i).name);
  }
  for (int j = 0; j < constraint.n_loop; j++) {
    const rows_loop *const l = &constraint.loop[j];
    for (int i = 0; i < rows_held(l->joint); i++) {
      tree_assign_one(w, code_constant(0.0), l->hold + i);
    }
  }
}

static void tree_write_rates(const code *w, int unused)
{
  (void)unused;
  code_template(w, tree_rates_head);
  code_template(w, "%V");
  tree_write_evaluation(w);
  if (!tree.system->allow_long_step) {
    tree_write_limit(w);
  } else {
    fputs("  (void)longest;\n", w->out);
  }
  code_template(w, "  return @_ok;\n}\n");
}

/* ---- the end of a step of free flight */

/* First moments of mass, summed from the tips: c[3] of the tree about O of the root, its axes (E9.22). */
static void tree_write_center(const code *w, int unused)
{
  static code_value first[FB_MAX_BODIES][3];
  static double bulk[FB_MAX_BODIES];
  code_sum s;
  (void)unused;
  code_template(w, "\n/* E9.22: first moment of mass of the whole about O of the root, body axes */\n"
                   "static void @_center(%M$ *c, const $ *x");
  code_template(w, tree.flown ? ", const @_input *in)\n{\n%V" : ")\n{\n%V");
  tree_write_names(w);
  tree_write_given_names(w, "in");
  tree_write_places(w, LARGE_POSED);
  for (int k = 0; k < tree.n; k++) {
    code own;
    own = tree_enter(w, k);
    memset(code_now.valued, 0, sizeof code_now.valued);
    code_write_lambda(&own);
    for (int i = 0; i < 3; i++) {
      code_write_slope(&own, i);
      code_write_value(&own, i);
      first[k][i] = code_model.large ? large_write_center(&own, i, k) : code_now.value[i];
    }
    tree_leave(k);
    bulk[k] = (double)tree.link[k].model->mass;
  }
  for (int k = tree.n - 1; k >= 0; k--) {
    const int to = tree.link[k].parent;
    for (int i = 0; i < 3 && to >= 0; i++) {
      code_begin(&s);
      code_add_one(&s, 1.0, first[to][i]);
      tree_add_turned(&s, tree.link[k].C, 0, first[k], i);
      code_add_one(&s, bulk[k], tree.link[k].s[i]);
      first[to][i] = code_end(w, &s, code_variable("b%d_c%d_%c", to, k, tree_axis[i]));
    }
    if (to >= 0) {
      bulk[to] += bulk[k];
    }
  }
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, first[tree.root][i]);
    code_assign(w, &s, code_variable("c[%d]", i).name);
  }
  fputs("  (void)x;\n}\n", w->out);
}

/* E9.24 of a body: momenta by the velocity v of the whole, body axes, in b; of its modes subtracted from d. */
static void tree_write_drift_of(const code *w, int k, const code_value v[3], code_value b[6])
{
  tree_link *const L = &tree.link[k];
  code_value e[FB_MAX_MODES];
  code_sum s;
  const code own = tree_enter(w, k);
  memset(code_now.valued, 0, sizeof code_now.valued);
  if (code_model.large) {
    large_write_inertia(&own, k);
  } else {
    code_write_lambda(&own);
  }
  for (int a = 0; a < L->n; a++) {
    code_begin(&s);
    for (int i = 0; i < 3; i++) {
      code_add(&s, 1.0, code_now.lambda[i][a], v[i]);
    }
    e[a] = code_end(w, &s, code_variable("e_%d", a));
  }
  if (code_model.constant_S && L->n > 0) {
    code_write_solve(&own, code_now.pb, e, "f");
  } else if (!code_model.large) {
    for (int i = 0; i < 3; i++) {
      code_write_slope(&own, i);
      code_write_value(&own, i);
    }
  }
  for (int i = 0; i < 6; i++) {
    code_begin(&s);
    if (code_model.constant_S && L->n > 0) {
      for (int j = 0; j < 3; j++) {
        code_add_one(&s, (double)L->model->S0[fb_sym6_index(i, j)], v[j]);
      }
      for (int a = 0; a < L->n; a++) {
        code_add(&s, 1.0, code_now.lambda[i][a], code_now.pb[a]);
      }
    } else if (i < 3) {
      code_add_one(&s, (double)L->model->mass, v[i]);
    } else {
      tree_add_cross(&s, 1.0, code_now.value, v, i - 3);
    }
    b[i] = code_end(w, &s, code_variable("D_%s", code_rows[i]));
  }
  tree_leave(k);
  for (int a = 0; a < L->n; a++) {
    char target[32];
    code_begin(&s);
    snprintf(target, sizeof target, "d[%d]", L->pi + a);
    code_add_one(&s, 1.0, code_variable("%s", target));
    code_add_one(&s, -1.0, e[a]);
    code_assign(w, &s, target);
  }
}

/* E9.24 of the axes of link k by the momentum b of all that hangs on them: subtracted from d. */
static void tree_write_drift_axes(const code *w, int k, const code_value b[6])
{
  const tree_link *const L = &tree.link[k];
  code_value p[3];
  code_sum s;
  for (int a = 0; a < L->axes; a++) {
    if (tree_is_free(L, a)) {
      p[a] = tree_write_along(w, L->A[a], b, code_variable("b%d_d_%d", k, a));
    }
  }
  if (tree_is_ball(L) && L->free > 0) {
    tree_write_out_of_ball(w, p, "db", "dg", k);
  }
  for (int a = 0; a < L->axes; a++) {
    if (tree_is_free(L, a)) {
      char target[32];
      snprintf(target, sizeof target, "d[%d]", L->p + a);
      code_begin(&s);
      code_add_one(&s, 1.0, code_variable("%s", target));
      code_add_one(&s, -1.0, p[a]);
      code_assign(w, &s, target);
    }
  }
}

/* E9.23: all momenta less those by a change of the frame's velocity. */
static void tree_write_drift(const code *w, int unused)
{
  static code_value b[FB_MAX_BODIES][6];
  code_value change[3];
  code_sum s;
  (void)unused;
  code_template(w,
                "\n/* E9.23: the increments d of the momenta at x less those by the velocity `change` of the frame */\n"
                "static @_NOINLINE void @_drift(%M$ *d, const $ *x, const $ *change");
  code_template(w, tree.flown ? ", const @_input *in)\n{\n%V  $ R[9], moved[3];\n" : ")\n{\n%V  $ R[9], moved[3];\n");
  tree_write_names(w);
  tree_write_given_names(w, "in");
  code_template(w, "  @_matrix(R, x);\n");
  tree_write_places(w, LARGE_MOVING);
  for (int i = 0; i < 3; i++) {
    change[i] = code_variable("change[%d]", i);
  }
  for (int k = 0; k < tree.n; k++) {
    code_value v[3];
    if (tree_flies(k)) {
      tree_write_view(w, v, change, "v", k, 1);
      tree_write_drift_of(w, k, v, b[k]);
    } else {
      tree_nothing(b[k], 6);
    }
  }
  for (int k = tree.n - 1; k >= 0; k--) {
    tree_write_drift_axes(w, k, b[k]);
    if (tree.link[k].parent >= 0) {
      tree_write_pass(w, b[tree.link[k].parent], b[k], "d", k);
      node_write_passed(w, "d", -1.0, k);
    }
  }
  for (int half = 0; half < 2; half++) {
    for (int i = 0; i < 3; i++) {
      code_begin(&s);
      code_add_one(&s, 1.0, b[tree.root][3 * half + i]);
      code_assign(w, &s, code_variable("moved[%d]", i).name);
    }
    fprintf(w->out,
            "  for (int i = 0; i < 3; i++) {\n    d[%d + i] -= R[3 * i] * moved[0] + R[3 * i + 1] * moved[1] + R[3 * i "
            "+ 2] * moved[2];\n  }\n",
            tree.link[tree.root].p + 3 * half);
  }
  fputs("}\n", w->out);
}

static const char tree_align[] =
    "\n/* E11.28: the increment d of the attitude so that R h is along L, both about the mass center at c/m */\n"
    "static void @_align(%M$ *d, const $ *x, const $ *center, int pushed)\n{\n%K%V"
    "  $ quat[4], h[3], a[3], b[3], theta[3], sizes, told;\n"
    "  const $ change = pushed ? @_norm(d + @_L) : %z;\n"
    "  for (int i = 0; i < 4; i++) {\n    quat[i] = x[i] + d[i];\n  }\n"
    "  for (int i = 0; i < 3; i++) {\n    h[i] = x[4 + i] + d[4 + i];\n    b[i] = x[@_L + i] + d[@_L + i];\n  }\n"
    "  @_turn(a, quat, h);\n"
    "  if (pushed) {\n"
    "    $ P[3], arm[3];\n"
    "    @_turn(arm, quat, center);\n"
    "    for (int i = 0; i < 3; i++) {\n      P[i] = ";

static const char tree_align_moment[] = " * (x[@_P + i] + d[@_P + i]);\n    }\n"
                                        "    for (int i = 0; i < 3; i++) {\n"
                                        "      const int y = i == 2 ? 0 : i + 1, z = i == 0 ? 2 : i - 1;\n"
                                        "      const $ moment = P[y] * arm[z] - P[z] * arm[y];\n"
                                        "      a[i] += moment;\n      b[i] += moment;\n    }\n  }\n"
                                        "  sizes = @_norm(a) * @_norm(b);\n"
                                        "  theta[0] = a[1] * b[2] - a[2] * b[1];\n"
                                        "  theta[1] = a[2] * b[0] - a[0] * b[2];\n"
                                        "  theta[2] = a[0] * b[1] - a[1] * b[0];\n"
                                        "  told = %Tsizes > change * change%t;\n";

static const char tree_vector[] = "\n/* E4.5: rotation vector of a quaternion, at most half a turn */\n"
                                  "static void @_vector($ *v, const $ *q)\n{\n"
                                  "  const $ size = @_norm(q + 1), sign = q[0] < `0` ? -`1` : `1`;\n"
                                  "  const $ by = size > `0` ? `2` * atan2~(size, sign * q[0]) / size * sign : `2`;\n"
                                  "  for (int i = 0; i < 3; i++) {\n    v[i] = by * q[1 + i];\n  }\n}\n";

static const char tree_keep[] =
    "\n/* x += d, what rounding takes goes to `lost` */\n"
    "static void @_keep($ *x, $ *lost, const $ *d)\n{\n"
    "  for (int i = 0; i < 3; i++) {\n"
    "    const $ a = x[i], sum = a + d[i], b = sum - a, rest = lost[i] + ((a - (sum - b)) + (d[i] - b));\n"
    "    x[i] = sum + rest;\n    lost[i] = rest - (x[i] - sum);\n  }\n}\n";

/* ---- the rest of the step */

/* Is there a joint of that kind? */
static int tree_has_joint(fb_joint_kind kind)
{
  int has = 0;
  for (int k = 0; k < tree.n; k++) {
    has |= tree.system->joint[k].kind == kind;
  }
  return has;
}

/* Does a rotation vector matter to a step, or to the energy, to which springs of joints that are given do? */
static int tree_has_sprung_ball(int energy)
{
  int has = 0;
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    has |= tree_is_ball(L) && (energy || L->free > 0) && L->joint->stiffness[0] > FB_R(0.0);
  }
  return has || rows_has_sprung_ball();
}

/* Does the frame of the free tree go where its mass center does, or come to rest? */
static int tree_leads(void)
{
  return tree.root >= 0 && !tree.tied;
}

/* Calls `f` for each piece of the vector that link k has: where, how many numbers, the member of the state. */
typedef void tree_piece(const code *w, int at, int n, int k, const char *member);

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

static void rows_pieces(const code *w, int k, tree_piece *f)
{
  const rows_loop *const l = &constraint.loop[k - tree.n];
  const int n = rows_held(&tree.system->joint[k]);
  if (n > 0) {
    f(w, l->hold, n, k, n == 4 ? "hold_quat" : "hold");
  }
}

static void tree_pieces(const code *w, int k, tree_piece *f)
{
  const tree_link *const L = &tree.link[k < tree.n ? k : 0];
  const int root = k < tree.n && tree_is_root(k), ball = tree_is_ball(L) || root, places = root ? 4 : tree_places_of(L);
  const int momenta = root ? 6 : tree_momenta_of(L);
  if (k >= tree.n) {
    rows_pieces(w, k, f);
    return;
  }
  if (places > 0) {
    f(w, L->x, places, k, ball ? "quat" : "x");
  }
  if (momenta > 0) {
    f(w, L->p, momenta, k, "p");
  }
  if (L->n > 0) {
    f(w, L->q, L->n, k, "q");
    f(w, L->pi, L->n, k, "pi");
  }
  if (L->model->n_rotor > 0) {
    f(w, L->angle, L->model->n_rotor, k, "rotor_angle");
    f(w, L->spun, L->model->n_rotor, k, "rotor_momentum");
  }
}

#include "code_close.h"
#include "code_drive.h"

static int tree_has_state(int k)
{
  return tree_is_root(k) || tree.link[k].axes + tree.link[k].n + tree.link[k].model->n_rotor > 0;
}

static void tree_declare(const code *w, int at, int n, int k, const char *member)
{
  (void)at;
  fprintf(w->out, "    %s %s[%d]", code_real(w), member, n);
  if (w->single && k < tree.n) {
    fprintf(w->out, ", lost_%s[%d]", member, n);
  }
  fputs(";\n", w->out);
}

static void tree_take(const code *w, int at, int n, int k, const char *member)
{
  (void)n;
  fprintf(w->out, "  memcpy(x + %d, s->%s.%s, ", at, tree_part(k), member);
  fprintf(w->out, "sizeof s->%s.%s);\n", tree_part(k), member);
}

static void tree_give(const code *w, int at, int n, int k, const char *member)
{
  (void)n;
  fprintf(w->out, "  memcpy(next.body_%d.%s, d + %d, sizeof next.body_%d.%s);\n", k, member, at, k, member);
}

/* d becomes x + d; small momenta and coordinates of modes become zero. */
static void tree_sum(const code *w, int at, int n, int k, const char *member)
{
  static const char *const small[] = {"", "    d[i] = %Ffabs~(d[i]) < @_tiny%:d[i]%;;\n",
                                      "    d[i] = %Ffabs~(d[i]) < @_faint%:d[i]%;;\n"};
  const char *const least = small[member[0] == 'r'   ? 1
                                  : member[0] == 'q' ? member[1] != 'u'
                                  : member[0] != 'p' ? 0
                                  : member[1] == 'i' ? 1
                                                     : 2];
  if (w->single) {
    code_template(w, "  @_sum_kept(");
    fprintf(w->out, "d + %d, next.body_%d.lost_%s, x + %d, %d);\n", at, k, member, at, n);
  }
  if (!w->single || least[0]) {
    fprintf(w->out, "  for (int i = %d; i < %d; i++) {\n%s", at, at + n, w->single ? "" : "    d[i] += x[i];\n");
    if (least[0]) {
      code_template(w, least);
    }
    fputs("  }\n", w->out);
  }
}

static void tree_sum_places(const code *w, int at, int n, int k, const char *member)
{
  if (k >= tree.n) { /* which stays */
    fprintf(w->out, "  memcpy(d + %d, x + %d, %d * sizeof *d);\n", at, at, n);
  } else if (member[0] != 'p') {
    tree_sum(w, at, n, k, member);
  }
}

static void tree_sum_momenta(const code *w, int at, int n, int k, const char *member)
{
  if (member[0] == 'p') {
    tree_sum(w, at, n, k, member);
  }
}

static void tree_units(const code *w, int at, int n, int k, const char *member)
{
  (void)n, (void)k;
  if (strcmp(member, "quat") == 0) {
    code_template(w, "  status = status == @_ok ? @_unit(");
    fprintf(w->out, "d + %d, x + %d) : status;\n", at, at);
  }
}

static void tree_lengths(const code *w, int at, int n, int k, const char *member)
{
  (void)n, (void)k;
  if (strcmp(member, "quat") == 0) {
    fprintf(w->out, "  norm2 = d[%d] * d[%d] + d[%d] * d[%d] + d[%d] * d[%d] + d[%d] * d[%d];\n", at, at, at + 1,
            at + 1, at + 2, at + 2, at + 3, at + 3);
    code_template(w, "  status = status == @_ok && !%((fabs~(norm2 - `1`) <= `2e-3`)%) ? @_step_length : status;\n");
  }
}

static const char *const tree_kinds[] = {"free",        "rigid", "revolute",  "prismatic",
                                         "cylindrical", "screw", "universal", "spherical"};

static const char tree_status[] =
    "typedef enum @_status { /* values of fb_status */\n"
    "  @_ok = 0,\n  @_null = -1,        /* a pointer is NULL */\n"
    "  @_value = -2,       /* dt is not above 0 */\n"
    "  @_not_finite = -3,  /* not finite, or so large that its square is not */\n"
    "  @_step_length = -9, /* dt is longer than the stability limit, or a body turns too far in a step */\n"
    "  @_range = -10       /* a deflection is out of range, points of a spring meet, a center is too near */\n";

/* Are there prescribed values? */
static int tree_is_told(void)
{
  return tree.n_valued + constraint.n_valued > 0;
}

/* One more, where it can be. */
static const char *tree_contradiction(void)
{
  return tree_is_told()     ? "  , @_contradiction = -12 /* a prescribed value jumps, or loops cannot be closed */\n"
         : constraint.n > 0 ? "  , @_contradiction = -12 /* loops cannot be closed */\n"
                            : "";
}

static const char tree_status_end[] =
    "} @_status;\n\n"
    "/* All that changes: members of fb_system_state.link[k] in body_k, in the same axes and units; a member that the\n"
    "   joint or the body does not use is left out. */\n";

static const char tree_tied_state[] = "    $ x[3];      /* [m] position of O, inertial axes */\n"
                                      "    $ lost_x[3]; /* what it has lost by rounding */\n";

static const char tree_free_state[] =
    "    $ x[3];                  /* [m] position of O, inertial axes */\n"
    "    $ u[3];                  /* [m/s] velocity of the frame that momenta are relative to, inertial axes */\n"
    "    $ lost_x[3], lost_u[3];  /* what x and u have lost by rounding */\n";

static const char tree_declarations[] =
    "void @_start(@_state *state);\n"
    "/* One step of classical Runge-Kutta, dt [s], under what acts at its start, middle and end. Refused: the state "
    "stays as\n"
    "   it was. */\n"
    "@_status @_step(%M@_state *state, const @_input *start, const @_input *middle, const @_input *end, $ dt);\n";

static void tree_write_state_type(const code *w)
{
  code_template(w, "typedef struct @_state {\n");
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    if (tree_has_state(k)) {
      fprintf(w->out, "  struct { /* %s, %s */\n", tree.names[k], tree_kinds[(int)L->joint->kind]);
      if (tree_is_root(k)) {
        code_template(w, tree.tied ? tree_tied_state : tree_free_state);
      }
      if (tree_is_valued(L) && tree_places_of(L) == 0) {
        fprintf(w->out, "    %s x[%d]; /* prescribed, where the last step had it */\n", code_real(w), L->axes);
      }
      tree_pieces(w, k, tree_declare);
      fprintf(w->out, "  } body_%d;\n", k);
    }
  }
  for (int k = tree.n; k < tree_parts(); k++) {
    if (rows_held(&tree.system->joint[k]) > 0) {
      fprintf(w->out, "  struct { /* where its axes are locked */\n");
      tree_pieces(w, k, tree_declare);
      fprintf(w->out, "  } %s;\n", tree_part(k));
    }
  }
  code_template(w, tree.work >= 0 ? "  $ motor_work; /* [J] */\n} @_state;\n\n" : "} @_state;\n\n");
}

/* What acts on a body or on the joint of a loop. 0: nothing. */
static int tree_write_input_of(const code *w, int k)
{
  const tree_link *const L = &tree.link[k < tree.n ? k : 0];
  if (k < tree.n ? tree.quiet && L->axes + L->model->n_rotor == 0 : tree_input_size(k, TREE_RATE) == 0) {
    return 0;
  }
  fputs("  struct {\n", w->out);
  for (int m = 0; m < TREE_INPUTS; m++) {
    if (tree_input_size(k, m) > 0) {
      fprintf(w->out, "    %s %s[%d]; /* %s */\n", code_real(w), tree_input_name(m), tree_input_size(k, m),
              tree_input_what(m));
    }
  }
  fprintf(w->out, "  } %s;\n", tree_part(k));
  return 1;
}

static void tree_write_types(const code *w)
{
  int n = 0;
  tree_write_state_type(w);
  code_template(w, "typedef struct @_input { /* what acts at one instant; all zero, or NULL: nothing */\n");
  for (int k = 0; k < tree_parts(); k++) {
    n += tree_write_input_of(w, k);
  }
  for (int j = 0; j < tree.system->n_spring; j++) {
    if (spans_is_pulled(j)) {
      fprintf(w->out, "  %s pull_%d; /* [N] of the actuator of spring %d, which draws its points together */\n",
              code_real(w), j, j);
      n++;
    }
  }
  code_template(w, n > 0 ? "" : "  $ none;\n");
  code_template(w, "} @_input;\n\n");
}

/* Comment at the head: what is written, and of what. */
static void tree_write_head(const code *w, const char *source, unsigned crc)
{
  const char *const scheme = tree.implicit ? "sdirk" : "rk4";
  fprintf(w->out, "/* %s - made by scene --code from ", w->name);
  output_source(w->out, source);
  fprintf(w->out,
          " with flexbeam %s, %s precision, model 0x%08X: %d\n   bodies on joints and their step of %s, by the "
          "equations of fb_system_%s_step (%s: tests/reference/THEORY.md).\n"
          "   Include it where needed; one file defines %s_IMPLEMENTATION before. SI units, radians. Mass %.6g kg.",
          FB_VERSION, w->single ? "single" : "double", crc, tree.n, scheme, scheme, tree.implicit ? "E11.14" : "E9.15",
          w->name, tree.mass);
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    fprintf(w->out, "\n   body_%d: %s, %d modes, %s", k, tree.names[k], L->n, tree_kinds[(int)L->joint->kind]);
    if (k != tree.root) {
      fprintf(w->out, " on %s", L->parent < 0 ? "the ground" : tree.names[L->parent]);
    }
  }
  fprintf(w->out, " */\n#ifndef %s_CODE\n#define %s_CODE\n#define %s_crc 0x%08Xu\n", w->name, w->name, w->name, crc);
  fputs("#ifdef __cplusplus\nextern \"C\" {\n#endif\n", w->out);
}

static const char tree_finite[] = "static int @_is_finite(const $ *x, int n)\n{\n"
                                  "  $ sum = %z;\n  @_UNROLL\n"
                                  "  for (int i = 0; i < n; i++) {\n    sum += fabs~(x[i]);\n  }\n"
                                  "  return %(sum <= @_huge%);\n}\n\n";

/* Are the numbers of an input finite? */
static void tree_write_input_check(const code *w)
{
  int n = 0;
  code_template(w, "static int @_input_is_finite(const @_input *in)\n{\n  return !in || (");
  for (int k = 0; k < tree_parts(); k++) {
    for (int m = 0; m < TREE_INPUTS; m++) {
      if (tree_input_size(k, m) > 0) {
        code_template(w, n++ > 0 ? " &&\n                 @_is_finite(" : "@_is_finite(");
        fprintf(w->out, "in->%s.%s, %d)", tree_part(k), tree_input_name(m), tree_input_size(k, m));
      }
    }
  }
  for (int j = 0; j < tree.system->n_spring; j++) {
    if (spans_is_pulled(j)) {
      code_template(w, n++ > 0 ? " &&\n                 @_is_finite(" : "@_is_finite(");
      fprintf(w->out, "&in->pull_%d, 1)", j);
    }
  }
  fputs(n > 0 ? ");\n}\n\n" : "1);\n}\n\n", w->out);
}

static void tree_write_enter(const code *w)
{
  code_template(w, "\n/* The vector x of a state: ");
  fputs(tree.root >= 0 ? "of the root quat and h = R^T L; by bodies the" : "by bodies the", w->out);
  code_template(
      w, " coordinates and\n   momenta of the joint, those of the modes; of the root P, L and its place; work. */\n"
         "static void @_enter($ *x, const @_state *s)\n{\n  memset(x, 0, @_N * sizeof *x);\n  (void)s;\n");
  for (int k = 0; k < tree_parts(); k++) {
    tree_pieces(w, k, tree_take);
  }
  if (tree.root >= 0) {
    code_template(w, "  @_turn_back(x + 4, x, x + @_L);\n");
  }
  if (tree.tied) {
    fprintf(w->out, "  memcpy(x + %d, s->body_%d.x, 3 * sizeof *x);\n", tree.link[tree.root].p + 6, tree.root);
  }
  if (tree.tracked) {
    fputs("  for (int i = 0; i < 3; i++) {\n", w->out);
    code_template(w, "    x[@_WHERE + i] = ");
    fprintf(w->out, "s->body_%d.x[i] + s->body_%d.lost_x[i];\n", tree.root, tree.root);
    code_template(w, "    x[@_FRAME + i] = ");
    fprintf(w->out, "s->body_%d.u[i];\n  }\n", tree.root);
  }
  fputs("}\n", w->out);
}

/* Numbers of a member at the start; zeros are there already. */
static void tree_write_start_of(const code *w, int k, const char *member, const fb_real *x, int n)
{
  char number[40];
  for (int i = 0; i < n; i++) {
    if (fabs((double)x[i]) > 0.0) {
      code_number(number, w, (double)x[i]);
      fprintf(w->out, "  state->%s.%s[%d] = %s;\n", tree_part(k), member, i, number);
    }
  }
}

static void tree_write_start(const code *w, const fb_system_state *start)
{
  static const fb_real unit[4] = {FB_R(1.0), 0, 0, 0};
  code_template(w, "\nvoid @_start(@_state *state)\n{\n  memset(state, 0, sizeof *state);\n");
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    const int free = tree_is_root(k), ball = free || L->joint->kind == FB_JOINT_SPHERICAL;
    const fb_link_state *const x = start ? &start->link[k] : NULL;
    if (ball) {
      tree_write_start_of(w, k, "quat", x ? x->quat : unit, 4);
    }
    if (x) {
      tree_write_start_of(w, k, "x", x->x, free ? 3 : ball ? 0 : L->axes);
      tree_write_start_of(w, k, "u", x->u, free && !tree.tied ? 3 : 0);
      tree_write_start_of(w, k, "p", x->p, free ? 6 : tree_momenta_of(L));
      tree_write_start_of(w, k, "q", x->q, L->n);
      tree_write_start_of(w, k, "pi", x->pi, L->n);
      tree_write_start_of(w, k, "rotor_angle", x->q + L->n, L->model->n_rotor);
      tree_write_start_of(w, k, "rotor_momentum", x->pi + L->n, L->model->n_rotor);
    }
  }
  for (int k = tree.n; k < tree_parts(); k++) {
    const int n = rows_held(&tree.system->joint[k]);
    if (n == 4) {
      tree_write_start_of(w, k, "hold_quat", start ? start->hold_quat[k] : unit, 4);
    } else if (start) {
      tree_write_start_of(w, k, "hold", start->hold[k], n);
    }
  }
  fputs("}\n", w->out);
}

/* Magnitude of mode a of link k in a vector. */
static code_value tree_write_size(const code *w, const char *of, int k, int a)
{
  if (!w->lanes) {
    return code_variable("fabs%s(%s[%d])", w->single ? "f" : "", of, tree.link[k].q + a);
  }
  code_template(w, "  const $ ");
  fprintf(w->out, "size_%d_%d = %s_wide_abs(%s[%d]);\n", k, a, w->name, of, tree.link[k].q + a);
  return code_variable("size_%d_%d", k, a);
}

/* Deflection of each body within its limit. */
static void tree_write_range(const code *w)
{
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    char number[40], target[40];
    code_sum s;
    const int limited = L->n > 0 && L->model->deflection_limit < FB_HUGE; /* lines have their own limit */
    code_begin(&s);
    for (int a = 0; a < L->n && limited; a++) {
      if (L->model->reach[a] > FB_R(0.0)) {
        code_add_one(&s, (double)L->model->reach[a], tree_write_size(w, "d", k, a));
      }
    }
    if (limited) {
      snprintf(target, sizeof target, "bent_%d", k);
      code_declare(w, &s, target);
      code_number(number, w, (double)L->model->deflection_limit);
      code_template(w, "  status = status == @_ok && !%((");
      fprintf(w->out, "bent_%d <= %s", k, number);
      code_template(w, ")%) ? @_range : status;\n");
    }
    large_write_end(w, k);
  }
}

/* Of all lanes: one whose frame keeps its velocity keeps its bits. */
static const char tree_drift_lanes[] =
    "  {\n    const $ moved = fabs~(change[0]) + fabs~(change[1]) + fabs~(change[2]);\n"
    "    if (!%(moved <= `0`%)) {\n"
    "      $ still[@_N];\n"
    "      memcpy(still, d, sizeof still);\n"
    "      @_drift(%Ad, d, change";

static const char tree_drift_lanes_end[] =
    ");\n"
    "      for (int i = 0; i < @_N; i++) {\n        d[i] = @_either(moved > `0`, d[i], still[i]);\n      }\n    }\n  "
    "}\n";

/* Change of the velocity of the root's frame, momenta relative to it: E9.23. */
static void tree_write_reframe(const code *w)
{
  char root[16], number[40];
  snprintf(root, sizeof root, "body_%d", tree.root);
  code_number(number, w, 1.0 / tree.flying);
  code_template(w, "\n  /* E9.21, E9.23: the frame follows the mass center; momenta relative to it */\n"
                   "  for (int i = 0; i < 3 && pushed; i++) {\n");
  if (tree.stands) {
    fprintf(w->out, "    change[i] = -next.%s.u[i] - next.%s.lost_u[i];\n  }\n", root, root);
  } else {
    fprintf(w->out, "    change[i] = %s * ", number);
    code_template(w, tree.looped ? "d[@_P + i];\n  }\n" : "(x[@_P + i] + d[@_P + i]");
    if (!tree.looped) {
      fprintf(w->out, w->single ? " + next.%s.lost_p[i]);\n  }\n" : ");\n  }\n", root);
    }
  }
  code_template(w, w->lanes ? tree_drift_lanes
                            : "  if (fabs~(change[0]) + fabs~(change[1]) + fabs~(change[2]) > `0`) {\n"
                              "    @_drift(%Ad, d, change");
  code_template(w, tree.flown ? ", in" : "");
  code_template(w, w->lanes ? tree_drift_lanes_end : ");\n  }\n");
  if (!tree.stands && !tree.looped) {
    code_template(w, "  for (int i = 0; i < 3 && pushed; i++) {\n    d[@_P + i] = -x[@_P + i]");
    if (w->single) {
      fprintf(w->out, " - next.%s.lost_p[i]", root);
    }
    fputs(";\n  }\n", w->out);
  }
}

static const char tree_frame[] =
    "  for (int i = 0; i < 3; i++) {\n"
    "    step[i] = dt * @r.u[i];\n"
    "    @r.lost_x[i] += dt * @r.lost_u[i];\n  }\n"
    "  @_keep(@r.x, @r.lost_x, step);\n"
    "  if (pushed) {\n    @_keep(@r.u, @r.lost_u, change);\n  }\n"
    "  for (int i = 0; i < 3 && pushed; i++) {\n"
    "    const $ rest = @_faint + `4` * %e * fabs~(change[i]);\n"
    "    const $ lost = %Ffabs~(@r.lost_u[i]) < @_faint%:@r.lost_u[i]%;;\n"
    "    @r.lost_u[i] = %Ffabs~(@r.u[i]) < rest%:lost%;;\n"
    "    @r.u[i] = %Ffabs~(@r.u[i]) < rest%:@r.u[i]%;;\n  }\n"
    "  status = status == @_ok && !(@_is_finite(@r.x, 3) && @_is_finite(@r.u, 3)) ? @_not_finite : status;\n";

/* Place of O where the frame stands still for ever. */
static void tree_write_tied_place(const code *w)
{
  const int k = tree.root, at = tree.link[k].p + 6;
  fprintf(w->out, "  for (int i = 0; i < 3; i++) {\n    step[i] = d[%d + i] - x[%d + i];\n  }\n", at, at);
  code_template(w, "  @_keep(");
  fprintf(w->out, "next.body_%d.x, next.body_%d.lost_x, step);\n", k, k);
  code_template(w, "  status = status == @_ok && !@_is_finite(");
  fprintf(w->out, "next.body_%d.x, 3)", k);
  code_template(w, " ? @_not_finite : status;\n");
}

/* Place of O and velocity of the frame: E11.23. */
static void tree_write_flight(const code *w)
{
  char text[2000], number[40];
  size_t n = 0;
  code_template(w, "\n  /* E11.23: O from the mass center, which moves by the momentum; then with the frame */\n");
  if (tree.stands) {
    fprintf(w->out, "  for (int i = 0; i < 3; i++) {\n    next.body_%d.lost_x[i] += ", tree.root);
    code_template(w, "d[@_PLACE + i];\n  }\n");
  } else {
    code_number(number, w, 1.0 / tree.flying);
    code_template(w, "  @_turn(old, x, before);\n  @_turn(own, d, after);\n");
    fprintf(w->out, "  for (int i = 0; i < 3; i++) {\n    next.body_%d.lost_x[i] += %s * ", tree.root, number);
    code_template(w, "(old[i] - own[i] + d[@_PLACE + i]);\n  }\n");
  }
  for (const char *c = tree_frame; *c; c++) {
    if (*c == '@' && c[1] == 'r') {
      n += (size_t)snprintf(text + n, sizeof text - n, "next.body_%d", tree.root);
      c++;
    } else {
      text[n++] = *c;
    }
  }
  text[n] = '\0';
  code_template(w, text);
}

/* Momenta of the end, loops closed, relative to the frame: the increments to it, or the sums where there are loops. */
static void tree_write_end_momenta(const code *w)
{
  if (tree.root >= 0 && !tree.looped) {
    tree_write_reframe(w);
  }
  for (int k = 0; k < tree.n; k++) {
    tree_pieces(w, k, tree_sum_momenta);
  }
  code_template(w, tree.tied ? "  for (int i = 0; i < 3; i++) {\n    d[@_PLACE + i] += x[@_PLACE + i];\n  }\n" : "");
  code_template(w, constraint.n > 0 ? "  status = status == @_ok ? @_close(d, in) : status;\n" : "");
  if (tree.tied) {
    tree_write_tied_place(w);
    return;
  }
  if (tree.looped) {
    tree_write_reframe(w);
  }
  if (tree.root >= 0) {
    code_template(w, tree.stands ? "" : tree.flown ? "  @_center(%Aafter, d, in);\n" : "  @_center(%Aafter, d);\n");
    tree_write_flight(w);
  }
}

static void tree_write_end(const code *w)
{
  int balls = tree.root >= 0 || tree_has_joint(FB_JOINT_SPHERICAL);
  code_template(w, "\n/* The end of the step, from x by the increments d: the state, if it passes the checks. */\n"
                   "static @_status @_end(%M@_state *state, $ *d, const $ *x");
  code_template(w, tree_leads() ? ", const $ *before, %s dt, int pushed" : "");
  code_template(w, constraint.n > 0 || tree.flown
                       ? ", const @_input *in)\n{\n  @_state next = *state;\n  @_status status = @_ok;\n"
                       : ")\n{\n  @_state next = *state;\n  @_status status = @_ok;\n");
  code_template(w, tree_leads() ? "  $ change[3] = {%z, %z, %z}, step[3];\n" : tree.tied ? "  $ step[3];\n" : "");
  code_template(w, balls ? "%V  $ norm2;\n" : "%V");
  code_template(w, (tree.looped || tree.implicit) && tree.stands && !tree.tied ? "  (void)before;\n" : "");
  if (tree_leads()) {
    code_template(w, tree.stands ? "" : "  $ after[3], old[3], own[3];\n");
    code_template(w, tree.looped || tree.implicit ? "" : "  @_align(%Ad, x, before, pushed);\n");
  }
  for (int k = 0; k < tree.n; k++) {
    tree_pieces(w, k, tree_units);
  }
  code_template(w, "  if (status != @_ok) {\n    return status;\n  }\n");
  for (int k = 0; k < tree_parts(); k++) {
    tree_pieces(w, k, tree_sum_places);
  }
  for (int k = 0; k < tree.n; k++) {
    tree_pieces(w, k, tree_lengths);
  }
  tree_write_end_momenta(w);
  if (tree.work >= 0) {
    fprintf(w->out, "  next.motor_work += d[%d];\n", tree.work);
    code_template(w, "  status = status == @_ok && !@_is_finite(&next.motor_work, 1) ? @_not_finite : status;\n");
  }
  code_template(w, "\n  /* what fb_system_rk4_step checks after a step */\n"
                   "  status = status == @_ok && !@_is_finite(d, @_N) ? @_not_finite : status;\n");
  tree_write_range(w);
  code_template(w, "  if (status != @_ok) {\n    return status;\n  }\n");
  for (int k = 0; k < tree.n; k++) {
    for (int r = 0; r < tree.link[k].model->n_rotor; r++) {
      code_template(w, "  @_settle(");
      fprintf(w->out, "&d[%d]);\n", tree.link[k].angle + r);
    }
  }
  for (int k = 0; k < tree.n; k++) {
    tree_pieces(w, k, tree_give);
  }
  code_template(w, "  *state = next;\n  return @_ok;\n}\n");
}

/* Momenta that are given become those of the end of the step, whatever they were. */
static void tree_write_given_momenta(const code *w)
{
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    for (int r = 0; r < L->model->n_rotor; r++) {
      if (L->model->rotor[r].given) {
        fprintf(w->out, "  x[%d] = ", L->spun + r);
        code_template(w, "%z;\n");
        fprintf(w->out, "  sum[%d] = end ? end->body_%d.rotor_motor[%d] : ", L->spun + r, k, r);
        code_template(w, "%z;\n");
      }
    }
  }
}

static const char tree_step_head[] =
    "\n/* E11.12 */\n"
    "%S@_status @_step(%M@_state *state, const @_input *start, const @_input *middle, const @_input *end, %s dt)\n{\n"
    "  static const %s node[4] = {`0.5`, `0.5`, `1`, `1`};\n"
    "  static const %s weight[4] = {`1` / `6`, `1` / `3`, `1` / `3`, `1` / `6`};\n"
    "  const @_input *in[4];\n"
    "  $ x[@_N], at[@_N], rate[@_N]%Z, sum[@_N]%Z, w[3 * @_BODIES]";

static const char tree_step_begin[] = "  if (!state%Q) {\n    return @_null;\n  }\n"
                                      "  if (!(dt > `0` && dt < @_huge)) {\n    return @_value;\n  }\n"
                                      "  in[0] = start;\n  in[1] = in[2] = middle;\n  in[3] = end;\n"
                                      "  @_enter(x, state);\n"
                                      "  memcpy(at, x, sizeof at);\n";

static const char tree_step_limits[] = "\n    /* E11.15, E11.26: step limit at the start, rotation at every stage */\n"
                                       "    if (status == @_ok && stage == 0) {\n"
                                       "      status = %(dt <= longest%) ? @_ok : @_step_length;\n"
                                       "      memcpy(first, w, sizeof first);\n    }\n"
                                       "    if (stage > 0) {\n      int far = 0;\n";

static const char tree_step_turns[] = "      @_UNROLL\n"
                                      "      for (int i = 0; i < 3 * @_BODIES; i += 3) {\n"
                                      "        const $ a = dt * (w[i] - first[i]), b = dt * (w[i + 1] - first[i + "
                                      "1]), c = dt * (w[i + 2] - first[i + 2]);\n"
                                      "        far |= !%((a * a + b * b + c * c <= `0.25`)%);\n      }\n";

static const char tree_step_far[] = "      status = status == @_ok && far ? @_step_length : status;\n    }\n";

static const char tree_step_rest[] = "    if (status != @_ok) {\n      return status;\n    }\n"
                                     "    for (int i = 0; i < @_ALWAYS; i++) {\n      sum[i] += by * rate[i];\n      "
                                     "at[i] = x[i] + to * rate[i];\n    }\n"
                                     "    for (int i = @_ALWAYS; i < @_N && pushed; i++) {\n"
                                     "      sum[i] += by * rate[i];\n      at[i] = x[i] + to * rate[i];\n    }\n"
                                     "  }\n";

/* All lanes or none: where some have momentum and nothing acts, each takes its own step. */
static const char tree_pushed_lanes[] =
    "  if (!pushed) {\n"
    "    const $ momentum = fabs~(x[@_P]) + fabs~(x[@_P + 1]) + fabs~(x[@_P + 2]);\n"
    "    pushed = %(momentum > `0`%);\n"
    "    if (!pushed && !%(momentum <= `0`%)) {\n      return @_step_length;\n    }\n  }\n";

static void tree_write_step(const code *w)
{
  const int limited = !tree.system->allow_long_step;
  int always;
  code_template(w, tree_step_head);
  code_template(w, limited ? ", first[3 * @_BODIES], longest = %z" : "");
  code_template(w, tree_leads() ? ", center[3];\n  int pushed;\n" : ";\n  int pushed;\n");
  code_template(w, tree_step_begin);
  code_template(w, tree_is_told() ? drive_refused : "");
  code_template(w, w->lanes ? "  memset(rate, 0, sizeof rate);\n  memset(sum, 0, sizeof sum);\n" : "");
  code_template(w, w->lanes && limited ? "  memset(first, 0, sizeof first);\n" : "");
  code_template(w, !tree_leads() ? ""
                   : tree.flown  ? "  @_center(%Acenter, x, start);\n"
                                 : "  @_center(%Acenter, x);\n");
  always = tree.root >= 0 && (tree.pulled || tree.stands || tree.looped || tree.tracked);
  code_template(w, always ? "  pushed = 1;\n" : "  pushed = start || middle || end;\n");
  if (tree.root >= 0 && !always) {
    code_template(w, w->lanes ? tree_pushed_lanes
                              : "  pushed |= fabs~(x[@_P]) + fabs~(x[@_P + 1]) + fabs~(x[@_P + 2]) > `0`;\n");
  }
  code_template(w, "  for (int stage = 0; stage < 4; stage++) {\n"
                   "    const %s by = dt * weight[stage], to = dt * node[stage];\n"
                   "    @_status status = @_not_finite;\n    if (@_input_is_finite(in[stage])) {\n"
                   "      status = @_rates_at(%Arate, w, ");
  code_template(w, limited ? "stage == 0 ? &longest : NULL, at, in[stage], pushed);\n    }\n"
                           : "NULL, at, in[stage], pushed);\n    }\n");
  if (limited) {
    code_template(w, tree_step_limits);
    code_template(w, tree_step_turns);
    code_template(w, tree_step_far);
  }
  code_template(w, tree_step_rest);
  tree_write_given_momenta(w);
  fputs("  return ", w->out);
  code_template(w, tree.n_valued > 0 ? "@_drives_take(state, end, @_end(%Astate, sum, x" : "@_end(%Astate, sum, x");
  code_template(w, tree_leads() ? ", center, dt, pushed" : "");
  code_template(w, constraint.n > 0 || tree.flown ? ", end)" : ")");
  code_template(w, tree.n_valued > 0 ? ");\n}\n" : ";\n}\n");
}

#include "code_sdirk.h"
#include "code_motion.h"
#include "code_energy.h"

/* Rotation vector; of all lanes by that of one body. */
static void tree_write_vector(const code *w)
{
  if (!w->lanes) {
    code_template(w, tree_vector);
    return;
  }
  code_template(w, "\nstatic void @_vector($ *v, const $ *q)\n{\n");
  fprintf(w->out, "  for (int k = 0; k < %s_LANES; k++) {\n", w->name);
  code_template(w, "    %s own[3], from[4];\n    for (int i = 0; i < 4; i++) {\n      from[i] = q[i][k];\n    }\n");
  fprintf(w->out, "    %s_vector(own, from);\n", w->name);
  fputs("    for (int i = 0; i < 3; i++) {\n      v[i][k] = own[i];\n    }\n  }\n}\n", w->out);
}

/* The attitude of the root by the angular momentum. */
static void tree_write_align(const code *w)
{
  char number[40];
  code_template(w, tree_align);
  code_number(number, w, 1.0 / tree.flying);
  fputs(number, w->out);
  code_template(w, tree_align_moment);
  code_template_of(w, 1, code_align_single);
  code_template(w, code_align_end);
}

/* What the rest needs of rotations and sums. */
static void tree_write_rotations(const code *w)
{
  const int free = tree.root >= 0, ball = tree_has_joint(FB_JOINT_SPHERICAL);
  code_template(w, free || ball || rows_has_locked_ball() ? code_matrix : "");
  code_template(w, free || !w->lanes ? code_turn : "");
  code_template(w, free ? code_turn_back : "");
  code_template(w, w->lanes ? "" : rows_quat);
  code_template(w, !w->lanes && ((free && !tree.looped && !tree.implicit) || tree_has_sprung_ball(1)) ? code_norm : "");
  if (tree_has_sprung_ball(!w->lanes)) {
    tree_write_vector(w);
  }
  rows_write_vector(w);
  code_template_of(w, 1, tree.n_axis + tree.size > 0 ? code_sums : "");
  code_template(w, free || ball ? code_unit : "");
  if (tree.n_rotor > 0) {
    code_write_settle(w);
  }
}

/* What a table of numbers tells. */
static void tree_write_model_type(const code *w)
{
  if (w->vary & CODE_TABLE) {
    code_template(w, "typedef struct @_model { /* numbers in which systems of this form differ */\n  $ k[");
    fprintf(w->out, "%d];\n", tree.places);
    code_template(w, "} @_model;\n\n");
  }
}

/* Types, of one system and of lanes. */
static void tree_write_declarations(const code *w, int lanes, int started)
{
  code_template(w, tree_status);
  code_template(w, tree_contradiction());
  code_template(w, w->traced ? "  , @_singular = -5   /* inertia that is not above zero */\n" : "");
  code_template(w,
                tree.implicit
                    ? "  , @_convergence = -6 /* the last correction of a stage is not small: take a shorter step */\n"
                    : "");
  code_template(w, tree_status_end);
  tree_write_types(w);
  tree_write_model_type(w);
  if (!tree.quiet) {
    motion_write_types(w);
  }
  code_template(w, started ? "/* Where the scene starts. */\n" : "/* At zero coordinates, at rest. */\n");
  code_template(w, tree.implicit ? sdirk_declarations : tree_declarations);
  code_template(w, tree.quiet ? "" : motion_declarations);
  if (lanes) {
    code lane = *w;
    lane.lanes = CODE_LANES;
    code_lanes_template(w, code_lanes_width);
    tree_write_types(&lane);
    tree_write_model_type(&lane);
    code_lanes_template(w, code_lanes_declarations);
  }
  fputs("#ifdef __cplusplus\n}\n#endif\n#endif\n", w->out);
}

static void tree_write_sizes(const code *w)
{
  code_template(w, "enum { @_N = ");
  fprintf(w->out, "%d, ", tree.size);
  code_template(w, "@_BODIES = ");
  fprintf(w->out, "%d, ", tree.n);
  code_template(w, "@_ALWAYS = ");
  fprintf(w->out, "%d", tree.always);
  if (tree.root >= 0) {
    const int P = tree.link[tree.root].p;
    code_template(w, ", @_P = ");
    fprintf(w->out, "%d, ", P);
    code_template(w, "@_L = ");
    fprintf(w->out, "%d, ", P + 3);
    code_template(w, "@_PLACE = ");
    fprintf(w->out, "%d", P + 6);
    if (tree.tracked) {
      code_template(w, ", @_WHERE = ");
      fprintf(w->out, "%d, ", P + TREE_PUSHED);
      code_template(w, "@_FRAME = ");
      fprintf(w->out, "%d", P + TREE_PUSHED + 3);
    }
  }
  fputs(" };\n\n", w->out);
}

/* Which rows move anything: written once for nobody; if none does there are no loops. 0: there is no temporary file, see
   errno. */
static int rows_look(const code *w)
{
  code draft = *w;
  draft.out = tmpfile();
  if (!draft.out) {
    return 0;
  }
  tree_write_rates(&draft, 0);
  if (constraint.acting == 0) {
    constraint.n = 0;
    constraint.n_loop = rows_are_sprung() ? constraint.n_loop : 0;
  }
  return fclose(draft.out) == 0;
}

/* The functions of a step, of one system or of all lanes. 0: there is no temporary file, see errno. */
static int tree_write_functions(const code *w)
{
  int good;
  tree_write_sizes(w);
  code_template(w, tree_finite);
  tree_write_input_check(w);
  tree_write_rotations(w);
  good = large_write_functions(w) && (constraint.n == 0 || rows_look(w));
  if (constraint.n > 0) {
    rows_write_functions(w);
  }
  good = tree.implicit ? sdirk_write_functions(w) : code_write_pruned(w, tree_write_rates, 0) && good;
  if (constraint.n > 0) {
    good = code_write_pruned(w, rows_write_move, 0) && good;
    rows_write_close(w);
  }
  if (tree_leads()) {
    good = code_write_pruned(w, tree_write_center, 0) && good;
    good = code_write_pruned(w, tree_write_drift, 0) && good;
  }
  if (tree.root >= 0) {
    if (!tree.looped && !tree.implicit) {
      tree_write_align(w);
    }
    code_template(w, tree_keep);
  }
  tree_write_enter(w);
  tree_write_end(w);
  if (tree_is_told()) {
    drive_write_functions(w);
  }
  if (tree.n_valued > 0) {
    drive_write_take(w);
  }
  if (tree.implicit) {
    sdirk_write_step(w);
  } else {
    tree_write_step(w);
  }
  if (!w->lanes && !tree.quiet) {
    good = motion_write_functions(w) && energy_write_functions(w) && good;
  }
  return good;
}

/* All lanes at once, and the step that takes it. */
static int tree_write_lanes(const code *w)
{
  const code wide = code_lanes_begin(w);
  int good;
  code_lanes_template(w, code_lanes_angles);
  tree_write_types(&wide);
  tree_write_model_type(&wide);
  good = tree_write_functions(&wide);
  code_lanes_end(w);
  return good;
}

static const char tree_steps[] =
    "\n/* n steps of all lanes under what acts at the beginning, the middle and the end of each; done: before one that "
    "is refused,\n"
    "   which changes nothing. All begin where vectors do. */\n"
    "int @_steps(const void *model, void *state, const void *input, double dt, int n, int *done)\n{\n"
    "  @_status status = @_ok;\n"
    "  *done = 0;\n"
    "  while (*done < n && status == @_ok) {\n"
    "    const @_wide_input *const in = (const @_wide_input *)input + 2 * *done;\n"
    "    status = @_wide_step((const @_wide_model *)model, (@_wide_state *)state, in, in + 1, in + 2, dt);\n"
    "    *done += status == @_ok;\n"
    "  }\n"
    "  return status;\n}\n";

/* Lanes, by a table, of LANES systems that are driven by their motors and prescribed axes alone. */
static int tree_write_alone(const code *w)
{
  code wide = *w;
  int good;
  wide.lanes = CODE_WIDE;
  code_template(w, "#include <math.h>\n#include <string.h>\n#define @_LANES LANES\n\n"
                   "static const $ @_huge = `1e150`, @_tiny = `1e-100`, @_faint = `1e-106`;\n\n");
  code_template(w, code_helpers);
  if (tree_has_sprung_ball(0)) {
    code_template(w, code_norm);
    tree_write_vector(w);
  }
  code_lanes_template(w, code_lanes_roots[w->single]);
  code_lanes_template(w, code_lanes_vectors);
  code_lanes_template(w, code_lanes_angles);
  code_template(w, tree_status);
  code_template(w, tree_contradiction());
  code_template(w, tree_status_end);
  tree_write_types(&wide);
  tree_write_model_type(&wide);
  if (tree_is_told()) {
    code_template(w, drive_check);
  }
  good = tree_write_functions(&wide);
  code_lanes_template(w, tree_steps);
  return good;
}

/* The declarations of the step of a system, and where its functions begin; names: of its bodies; crc: the check word of the
   system. */
static code tree_write_begin(FILE *out, const fb_system *system, const fb_body *body, const char *const *names,
                             const tree_choice *choice, const char *source, unsigned crc)
{
  const code w = {out, choice->name,   choice->single, 0, 0, 2, choice->table ? CODE_TABLE : 0, 0, 0, choice->implicit,
                  0,   choice->traced, choice->table};
  code_numbers.n = 0;
  tree_read(system, body, names, choice);
  tree.places = choice->table;
  tree.quiet = choice->lanes == TREE_LANES_ALONE;
  if (tree.quiet) {
    return w;
  }
  tree_write_head(&w, source, crc);
  tree_write_declarations(&w, choice->lanes, choice->start != NULL);
  code_template(&w, "\n#ifdef @_IMPLEMENTATION\n#include <math.h>\n#include <string.h>\n\n");
  return w;
}

/* Writes the step of a system that tree_refusal takes. 0: there is no temporary file, see errno. */
static int tree_write(FILE *out, const fb_system *system, const fb_body *body, const char *const *names,
                      const tree_choice *choice, const char *source, unsigned crc)
{
  const code w = tree_write_begin(out, system, body, names, choice, source, crc);
  int good;
  if (tree.quiet) {
    return tree_write_alone(&w);
  }
  code_template(&w, w.single ? "static const $ @_huge = `1e18`, @_tiny = `1e-12`, @_faint = `1e-18`;\n\n"
                             : "static const $ @_huge = `1e150`, @_tiny = `1e-100`, @_faint = `1e-106`;\n\n");
  code_template(&w, code_helpers);
  code_template(&w, large_any(system, body) ? code_restrict : "");
  good = tree_write_functions(&w);
  tree_write_start(&w, choice->start);
  good = (!choice->lanes || tree_write_lanes(&w)) && good;
  fputs("#endif\n", out);
  return good;
}
#endif
