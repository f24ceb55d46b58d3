/* exact_text.h - text descriptions of a geometrically exact beam, read into a fb_exact_desc and what acts on it.
   README.md lists the words. Include flexbeam.h first. */
#ifndef EXACT_TEXT_H
#define EXACT_TEXT_H
#include "../common/section_doubt.h"
#include "../common/text.h"
#include "exact_curve.h"

typedef struct exact_spot { /* place on a line */
  double x;
  int on;
} exact_spot;

typedef struct exact_text { /* what was read; places want the whole file before they can be used */
  fb_exact_desc desc;
  fb_exact_input input;
  int modes, station_open;
  int station_line[FB_MAX_STATIONS];
  char doubt[SECTION_DOUBT + 64]; /* the first section of no material in SI units; empty: none */
  int on;                         /* line that the words are of: 0 the chain, else that branch */
  int n_station, n_load, n_line, n_support, n_lump, n_joint, n_move;
  exact_spot load_at[FB_MAX_LOADS], support_at[FB_MAX_LUMPS], lump_at[FB_MAX_LUMPS], joint_at[FB_MAX_LUMPS];
  exact_spot branch_at[FB_MAX_LUMPS], move_at[FB_MAX_LUMPS];
  int move_line[FB_MAX_LUMPS];
  int joint_node[FB_MAX_LUMPS];       /* without joints, along its line */
  int elements[FB_MAX_LUMPS + 1];     /* of the lines, without joints */
  int first[FB_MAX_LUMPS + 1], n_all; /* node x = 0 of a line; numbers of all elements */
  struct {
    exact_spot a, b;
    fb_line_load load;
  } line[64];
  exact_curve curve; /* the line through points, if there are some */
} exact_text;

/* 6, 21 or 36 numbers to a full 6x6. */
static void exact_matrix(text_file *t, const char *what, fb_real A[36])
{
  double x[36];
  int n = 0;
  while (text_more(t) && n < 36) {
    x[n++] = text_number(t, what);
  }
  if (n != 6 && n != 21 && n != 36) {
    text_fail(t, "%s wants 6, 21 or 36 numbers, not %d", what, n);
    return;
  }
  for (int i = 0, at = 0; i < 6; i++) {
    for (int j = 0; j < 6; j++) {
      if (n == 36) {
        A[6 * i + j] = (fb_real)x[6 * i + j];
      } else if (n == 6) {
        A[6 * i + j] = i == j ? (fb_real)x[i] : 0;
      } else if (j >= i) {
        A[6 * i + j] = A[6 * j + i] = (fb_real)x[at++];
      }
    }
  }
}

static int exact_end(text_file *t)
{
  static const struct {
    const char *name;
    int held;
  } ends[] = {
      {"clamped", FB_END_CLAMPED}, {"pinned", FB_END_PINNED}, {"guided", FB_END_GUIDED}, {"sliding", FB_END_SLIDING},
      {"free", FB_END_FREE},       {"x", FB_HOLD_X},          {"y", FB_HOLD_Y},          {"z", FB_HOLD_Z},
      {"rx", FB_HOLD_RX},          {"ry", FB_HOLD_RY},        {"rz", FB_HOLD_RZ}};
  int held = 0;
  do {
    const char *word = text_word(t);
    size_t k = 0;
    while (word && k < sizeof ends / sizeof ends[0] && strcmp(word, ends[k].name) != 0) {
      k++;
    }
    if (!word || k == sizeof ends / sizeof ends[0]) {
      text_fail(t, "an end is clamped, pinned, guided, sliding, free, or some of x y z rx ry rz");
      return 0;
    }
    held |= ends[k].held;
  } while (text_more(t));
  return held;
}

static fb_axes exact_axes(text_file *t)
{
  const char *word = text_word(t);
  if (word && strcmp(word, "dead") == 0) {
    return FB_AXES_INERTIAL;
  }
  if (word && strcmp(word, "follower") == 0) {
    return FB_AXES_NODE;
  }
  if (!word || strcmp(word, "base") != 0) {
    text_fail(t, "axes of a load are dead, follower or base");
  }
  return FB_AXES_BODY;
}

static void exact_force(text_file *t, fb_real force[3], fb_real torque[3])
{
  text_reals(t, "force x y z", force, 3);
  if (text_more(t)) {
    text_reals(t, "moment x y z", torque, 3);
  }
}

/* Words of a station; 0 if it is none of them. */
static int exact_section(text_file *t, exact_text *m, const char *word)
{
  static const char *const words[] = {"stiffness", "inertia", "mass", "twist", "curvature"};
  fb_exact_station *const s = &m->desc.station[m->n_station > 0 ? m->n_station - 1 : 0];
  int k = 0;
  while (k < 5 && strcmp(word, words[k]) != 0) {
    k++;
  }
  if (k < 5 && !m->station_open) {
    text_fail(t, "%s belongs to a station: begin it with \"station X\"", word);
  } else if (k == 0) {
    exact_matrix(t, word, s->stiffness);
  } else if (k == 1) {
    exact_matrix(t, word, s->inertia);
  } else if (k == 2) {
    fb_section section;
    fb_exact_station made;
    memset(&section, 0, sizeof section);
    section.mass = (fb_real)text_number(t, word);
    if (text_more(t)) {
      section.mass_y = (fb_real)text_number(t, "y of the mass center");
      section.mass_z = (fb_real)text_number(t, "z of the mass center");
    }
    if (fb_exact_station_init(&made, &section) != FB_OK) {
      text_fail(t, "mass is zero or more");
    }
    memcpy(s->inertia, made.inertia, sizeof s->inertia);
  } else if (k == 3) {
    s->twist = (fb_real)text_degrees(t, word);
  } else if (k == 4) {
    text_reals(t, word, s->curvature, 3);
  }
  return k < 5;
}

static void exact_station_line(text_file *t, exact_text *m)
{
  int *const n = m->on ? &m->desc.branch[m->on - 1].n_station : &m->desc.n_station;
  if (m->n_station == FB_MAX_STATIONS) {
    text_fail(t, "more than %d stations", FB_MAX_STATIONS);
    return;
  }
  if (m->n_station > 0) { /* what is not given is that of the station before */
    m->desc.station[m->n_station] = m->desc.station[m->n_station - 1];
  }
  if (m->on && *n == 0) {
    m->desc.branch[m->on - 1].station = m->n_station;
  }
  (*n)++;
  m->station_line[m->n_station] = t->line;
  m->desc.station[m->n_station++].x = (fb_real)text_number(t, "x of the station");
  m->station_open = 1;
}

static exact_spot exact_spot_read(text_file *t, const exact_text *m, const char *what)
{
  exact_spot spot;
  spot.x = text_number(t, what);
  spot.on = m->on;
  return spot;
}

/* branch X [N]: what follows is of a branch that begins at X of the chain, or of branch N. */
static void exact_branch(text_file *t, exact_text *m)
{
  if (m->desc.n_branch == FB_MAX_LUMPS) {
    text_fail(t, "more than %d branches", FB_MAX_LUMPS);
    return;
  }
  m->on = 0;
  m->branch_at[m->desc.n_branch] = exact_spot_read(t, m, "place of the branch");
  if (text_more(t) && m->desc.n_branch == 0) {
    text_fail(t, "the first branch begins on the beam: branch X, without a number");
  } else if (text_more(t)) {
    m->branch_at[m->desc.n_branch].on = text_whole(t, "branch that it begins on", 1, m->desc.n_branch);
  }
  m->on = ++m->desc.n_branch;
  m->station_open = 0;
}

static void exact_lump(text_file *t, exact_text *m)
{
  fb_lump *const lump = &m->desc.lump[m->n_lump];
  if (m->n_lump == FB_MAX_LUMPS) {
    text_fail(t, "more than %d lumps", FB_MAX_LUMPS);
    return;
  }
  m->lump_at[m->n_lump++] = exact_spot_read(t, m, "x of the lump");
  lump->mass = (fb_real)text_number(t, "mass");
  if (text_more(t)) {
    text_reals(t, "center x y z", lump->center, 3);
  }
  if (text_more(t)) {
    text_reals(t, "inertia xx yy zz", lump->inertia, 3);
  }
}

/* joint X, axis x y z, then what it has. */
static void exact_joint(text_file *t, exact_text *m)
{
  fb_exact_joint *const joint = &m->desc.joint[m->n_joint];
  if (m->n_joint == FB_MAX_LUMPS) {
    text_fail(t, "more than %d joints", FB_MAX_LUMPS);
    return;
  }
  m->joint_at[m->n_joint] = exact_spot_read(t, m, "x of the joint");
  text_reals(t, "axis x y z", joint->axis, 3);
  while (text_more(t)) {
    if (text_take(t, "angle")) {
      joint->angle = (fb_real)text_degrees(t, "angle");
    } else if (text_take(t, "rate")) {
      joint->rate = (fb_real)text_number(t, "rate");
    } else if (text_take(t, "rest")) {
      joint->rest = (fb_real)text_degrees(t, "rest");
    } else if (text_take(t, "stiffness")) {
      joint->stiffness = (fb_real)text_number(t, "stiffness");
    } else if (text_take(t, "damping")) {
      joint->damping = (fb_real)text_number(t, "damping");
    } else if (text_take(t, "motor")) {
      m->input.motor[m->n_joint] = (fb_real)text_number(t, "torque of the motor");
    } else if (text_take(t, "driven")) {
      joint->driven = 1;
      m->input.motor[m->n_joint] = joint->rate = (fb_real)text_number(t, "rate that is driven");
    } else {
      text_fail(t, "a joint has angle, rate, rest, stiffness, damping, motor, driven");
      return;
    }
  }
  m->n_joint++;
}

/* move X|tip DX DY DZ [RX RY RZ]: of what holds the beam there */
static void exact_move(text_file *t, exact_text *m)
{
  fb_support_place *const place = &m->input.support[m->n_move];
  if (m->n_move == FB_MAX_LUMPS) {
    text_fail(t, "more than %d moves of supports", FB_MAX_LUMPS);
    return;
  }
  m->move_line[m->n_move] = t->line;
  m->move_at[m->n_move].on = m->on;
  m->move_at[m->n_move++].x = text_take(t, "tip") ? HUGE_VAL : text_number(t, "x of the support, or tip");
  text_reals(t, "displacement x y z", place->displacement, 3);
  for (int i = 0, turns = text_more(t); i < 3 && turns; i++) {
    place->rotation[i] = (fb_real)text_degrees(t, "rotation vector x y z in degrees");
  }
}

/* Loads, supports, lumps and joints, which name places; 0 if it is none of them. */
static int exact_place(text_file *t, exact_text *m, const char *word)
{
  if (strcmp(word, "load") == 0) {
    fb_load *const load = &m->input.load[m->n_load];
    if (m->n_load == FB_MAX_LOADS) {
      text_fail(t, "more than %d loads", FB_MAX_LOADS);
      return 1;
    }
    m->load_at[m->n_load++] = exact_spot_read(t, m, "x of the load");
    load->axes = exact_axes(t);
    exact_force(t, load->force, load->torque);
  } else if (strcmp(word, "line") == 0) {
    if (m->n_line == 64) {
      text_fail(t, "more than 64 line loads");
      return 1;
    }
    m->line[m->n_line].a = exact_spot_read(t, m, "begin of the line load");
    m->line[m->n_line].b = exact_spot_read(t, m, "end of the line load");
    m->line[m->n_line].load.axes = exact_axes(t);
    exact_force(t, m->line[m->n_line].load.force, m->line[m->n_line].load.torque);
    m->n_line++;
  } else if (strcmp(word, "support") == 0) {
    if (m->n_support == FB_MAX_LUMPS) {
      text_fail(t, "more than %d supports", FB_MAX_LUMPS);
      return 1;
    }
    m->support_at[m->n_support] = exact_spot_read(t, m, "x of the support");
    m->desc.support[m->n_support++].held = exact_end(t);
  } else if (strcmp(word, "move") == 0) {
    exact_move(t, m);
  } else if (strcmp(word, "lump") == 0) {
    exact_lump(t, m);
  } else if (strcmp(word, "joint") == 0) {
    exact_joint(t, m);
  } else {
    return 0;
  }
  return 1;
}

/* Nothing is known yet. */
static void exact_begin(exact_text *m)
{
  memset(m, 0, sizeof *m);
  m->desc.n_element = 20;
  m->modes = 6;
}

/* What a branch has as the chain has it; 0 if the word is none of them. */
static int exact_own(text_file *t, exact_text *m, const char *word)
{
  fb_exact_branch *const branch = m->on ? &m->desc.branch[m->on - 1] : NULL;
  if (strcmp(word, "length") == 0) {
    *(branch ? &branch->length : &m->desc.length) = (fb_real)text_number(t, word);
  } else if (strcmp(word, "elements") == 0) {
    *(branch ? &branch->n_element : &m->desc.n_element) = text_whole(t, word, 1, FB_MAX_EXACT);
  } else if (strcmp(word, "station") == 0) {
    exact_station_line(t, m);
  } else if (strcmp(word, "attitude") == 0) {
    fb_real turn[3];
    for (int i = 0; i < 3; i++) {
      turn[i] = (fb_real)text_degrees(t, "attitude, a rotation vector x y z in degrees,");
    }
    fb_quat_from_rotvec(branch ? branch->attitude : m->desc.attitude, turn);
  } else {
    return exact_section(t, m, word) || exact_place(t, m, word);
  }
  return 1;
}

/* `damping`: one number for all strains, or six; `damping_ratio`: that of a motion at a frequency. */
static void exact_damping(text_file *t, exact_text *m, const char *word)
{
  double x[6] = {0};
  int n = 0;
  if (strcmp(word, "damping_ratio") == 0) {
    const double ratio = text_number(t, "ratio"), hertz = text_number(t, "frequency [Hz]");
    if (!(ratio >= 0 && hertz > 0)) {
      text_fail(t, "damping_ratio wants a ratio from 0 and a frequency above 0 Hz, not %g, %g", ratio, hertz);
    }
    x[n++] = ratio / (acos(-1.0) * hertz);
  }
  while (text_more(t) && n < 6 && strcmp(word, "damping") == 0) {
    x[n++] = text_number(t, word);
  }
  if (n != 1 && n != 6) {
    text_fail(t, "damping wants 1 or 6 numbers, not %d", n);
  }
  for (int i = 0; i < 6; i++) {
    m->desc.damping[i] = (fb_real)x[n == 6 ? i : 0];
  }
}

/* point X Y Z: of the reference line, base axes */
static void exact_point(text_file *t, exact_text *m)
{
  fb_real x[3] = {0};
  text_reals(t, "point x y z", x, 3);
  if (m->on) {
    text_fail(t, "points belong to the beam that branches begin on: before them");
  } else if (m->curve.n == CURVE_POINTS) {
    text_fail(t, "more than %d points", CURVE_POINTS);
  } else {
    for (int i = 0; i < 3; i++) {
      m->curve.x[m->curve.n][i] = (double)x[i];
    }
    m->curve.n++;
  }
}

/* A line that begins with that word. */
static void exact_line(text_file *t, exact_text *m, const char *word)
{
  if (strcmp(word, "branch") == 0) {
    exact_branch(t, m);
  } else if (exact_own(t, m, word)) {
    /* read */
  } else if (strcmp(word, "point") == 0) {
    exact_point(t, m);
  } else if (m->on && (strcmp(word, "position") == 0 || strcmp(word, "root") == 0 || strcmp(word, "tip") == 0)) {
    text_fail(t, "%s belongs to the beam that branches begin on: before them", word);
  } else if (strcmp(word, "position") == 0) {
    text_reals(t, word, m->desc.position, 3);
  } else if (strcmp(word, "root") == 0) {
    m->desc.root = exact_end(t);
  } else if (strcmp(word, "tip") == 0) {
    m->desc.tip = exact_end(t);
  } else if (strcmp(word, "gravity") == 0) {
    text_reals(t, word, m->desc.gravity, 3);
  } else if (strcmp(word, "velocity") == 0) {
    text_reals(t, word, m->input.v, 3);
  } else if (strcmp(word, "spin") == 0) {
    text_reals(t, word, m->input.w, 3);
  } else if (strcmp(word, "modes") == 0) {
    m->modes = text_whole(t, word, 0, FB_EXACT_MODES);
  } else if (strcmp(word, "dissipation") == 0) {
    m->desc.dissipation = (fb_real)text_number(t, word);
  } else if (strcmp(word, "damping") == 0 || strcmp(word, "damping_ratio") == 0) {
    exact_damping(t, m, word);
  } else if (strcmp(word, "box") == 0) {
    m->desc.box = 1;
  } else {
    text_fail(t, "no such word for an exact beam: %s", word);
  }
  text_end_of_line(t);
}

static double exact_length(const exact_text *m, int on)
{
  return (double)(on && m->desc.branch[on - 1].length > 0 ? m->desc.branch[on - 1].length : m->desc.length);
}

/* Is the first element of a line the joint that its attitude makes? */
static int exact_is_turned(const exact_text *m, int on)
{
  const fb_real *const q = m->desc.branch[on ? on - 1 : 0].attitude;
  return on && q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] > 0;
}

/* Joints of a line inboard of its own node. */
static int exact_joints_before(const exact_text *m, int on, int node)
{
  int n = 0;
  for (int k = 0; k < m->n_joint; k++) {
    n += m->joint_at[k].on == on && m->joint_node[k] < node;
  }
  return n;
}

/* Nearest of the line's own nodes. */
static int exact_own_node(text_file *t, const exact_text *m, const exact_spot *at, const char *what)
{
  const double L = exact_length(m, at->on);
  if (!(at->x >= -1e-9 * L && at->x <= L * (1 + 1e-9))) {
    text_fail(t, "%s at %g is not on the %s", what, at->x, at->on ? "branch" : "beam");
    return 0;
  }
  return (int)lround(at->x / L * m->elements[at->on]);
}

/* Nearest node; where joints are, the one inboard of them, but outboard of what a branch is turned by. */
static int exact_nearest(text_file *t, const exact_text *m, const exact_spot *at, const char *what)
{
  const int own = exact_own_node(t, m, at, what), along = own + exact_joints_before(m, at->on, own);
  return along == 0 && at->on && !exact_is_turned(m, at->on) ? m->desc.branch[at->on - 1].node
                                                             : m->first[at->on] + along;
}

/* Place on its line of a node that exact_nearest gave. */
static inline double exact_node_place(const exact_text *m, int on, int node)
{
  int own = node - m->first[on];
  for (int k = 0; k < m->n_joint; k++) {
    own -= m->joint_at[k].on == on && m->desc.joint[k].element < node;
  }
  return own > 0 ? exact_length(m, on) * own / m->elements[on] : 0;
}

static int exact_is_joint(const exact_text *m, int element)
{
  int is = 0;
  for (int k = 0; k < m->desc.n_joint; k++) {
    is = is || m->desc.joint[k].element == element;
  }
  return is;
}

/* Joints of a line become elements between those that the file counts; so does what turns a branch, before them. */
static void exact_joints(text_file *t, exact_text *m, int on)
{
  int *const n = on ? &m->desc.branch[on - 1].n_element : &m->desc.n_element;
  int joints = exact_is_turned(m, on);
  *n = *n > 0 ? *n : m->elements[0];
  m->elements[on] = *n;
  m->first[on] = m->n_all + joints;
  for (int k = 0; k < m->n_joint; k++) {
    if (m->joint_at[k].on == on) {
      m->joint_node[k] = exact_own_node(t, m, &m->joint_at[k], "a joint");
      joints++;
    }
  }
  *n += joints;
  m->n_all += *n;
  for (int k = 0; k < m->n_joint; k++) {
    int *const element = &m->desc.joint[k].element;
    if (m->joint_at[k].on != on) {
      continue;
    }
    *element = m->first[on] + m->joint_node[k];
    for (int j = 0; j < m->n_joint; j++) {
      *element += m->joint_at[j].on == on &&
                  (m->joint_node[j] < m->joint_node[k] || (j < k && m->joint_node[j] == m->joint_node[k]));
    }
  }
  if (on) {
    m->desc.branch[on - 1].node = exact_nearest(t, m, &m->branch_at[on - 1], "a branch");
  }
}

/* A line load, on the elements between two nodes. */
static void exact_line_load(text_file *t, exact_text *m, int l)
{
  const int on = m->line[l].a.on, node = exact_nearest(t, m, &m->line[l].a, "a line load");
  const int a = node < m->first[on] ? m->first[on] : node, b = exact_nearest(t, m, &m->line[l].b, "a line load");
  if (a >= b) {
    text_fail(t, "a line load from %g to %g covers no element", m->line[l].a.x, m->line[l].b.x);
  }
  for (int k = a; k < b && k < m->n_all; k++) {
    fb_line_load *const line = &m->input.line[k];
    const fb_real *const f = line->force, *const c = line->torque;
    const int taken = f[0] * f[0] + f[1] * f[1] + f[2] * f[2] + c[0] * c[0] + c[1] * c[1] + c[2] * c[2] > 0;
    if (exact_is_joint(m, k)) {
      continue;
    }
    if (taken && line->axes != m->line[l].load.axes) {
      text_fail(t, "line loads of different axes overlap");
    }
    line->axes = m->line[l].load.axes;
    for (int i = 0; i < 3; i++) {
      line->force[i] += m->line[l].load.force[i];
      line->torque[i] += m->line[l].load.torque[i];
    }
  }
}

/* The first section that is of no material in SI units. */
static void exact_doubt(exact_text *m)
{
  for (int k = 0, on = 0; k < m->n_station && !m->doubt[0]; k++) {
    const fb_exact_station *const s = &m->desc.station[k];
    const section_figures figures = {(double)s->inertia[0],    (double)s->stiffness[0],  (double)s->stiffness[21],
                                     (double)s->stiffness[28], (double)s->stiffness[35], (double)s->inertia[28],
                                     (double)s->inertia[35]};
    char text[SECTION_DOUBT];
    while (on < m->desc.n_branch && m->desc.branch[on].n_station > 0 && k >= m->desc.branch[on].station) {
      on++;
    }
    if (section_doubt(text, (double)s->x, on == 0 && m->curve.n > 0 ? m->curve.s[CURVE_STEPS] : exact_length(m, on),
                      &figures)) {
      snprintf(m->doubt, sizeof m->doubt, "line %d: %s", m->station_line[k], text);
    }
  }
}

/* The line through points: where the root is, its attitude, and its length if the file has none; of a length that it has
   places are parts. */
static void exact_curve_begin(text_file *t, exact_text *m)
{
  const fb_real *const x = m->desc.position, *const q = m->desc.attitude;
  const char *const wrong = curve_fill(&m->curve);
  if (wrong) {
    text_fail(t, "point: %s", wrong);
    return;
  }
  if (x[0] * x[0] + x[1] * x[1] + x[2] * x[2] > 0 || q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] > 0) {
    text_fail(t, "position and attitude follow from the points: leave them out");
  }
  for (int k = 0; k < m->n_station; k++) {
    const fb_real *const kappa = m->desc.station[k].curvature;
    if (kappa[0] * kappa[0] + kappa[1] * kappa[1] + kappa[2] * kappa[2] > 0) {
      text_fail(t, "curvature follows from the points: leave it out");
    }
  }
  for (int i = 0; i < 3; i++) {
    m->desc.position[i] = (fb_real)m->curve.x[0][i];
  }
  curve_attitude(&m->curve, m->desc.attitude);
  m->desc.length = m->desc.length > 0 ? m->desc.length : (fb_real)m->curve.s[CURVE_STEPS];
}

/* Section at s [m] of a line between its stations. */
static void exact_section_at(fb_exact_station *out, const fb_exact_station *list, int n, double s)
{
  int k = 0;
  while (k + 2 < n && s > (double)list[k + 1].x) {
    k++;
  }
  *out = list[k];
  if (n > 1) {
    const fb_exact_station *const a = &list[k], *const b = &list[k + 1];
    const fb_real part = ((fb_real)s - a->x) / (b->x - a->x);
    for (int i = 0; i < 36; i++) {
      out->stiffness[i] += part * (b->stiffness[i] - a->stiffness[i]);
      out->inertia[i] += part * (b->inertia[i] - a->inertia[i]);
    }
    out->twist += part * (b->twist - a->twist);
  }
  out->x = (fb_real)s;
}

/* Stations of the chain: those of the file and others between them, each with the curvature of the line there. What is
   linear between the file's stations stays so. */
static void exact_curve_stations(text_file *t, exact_text *m)
{
  static fb_exact_station given[FB_MAX_STATIONS], *s;
  const int n = m->desc.n_station, others = m->n_station - n;
  const double all = m->curve.s[CURVE_STEPS], scale = all / (double)m->desc.length;
  int room = FB_MAX_STATIONS - others, at = 0, between;
  memcpy(given, m->desc.station, sizeof given);
  for (int k = 0; k < n; k++) {
    given[k].x = n > 1 ? (fb_real)(scale * (double)given[k].x) : FB_R(0.0);
  }
  between = n > 1 ? (room - 1) / (n - 1) : room - 1; /* intervals in each of the file's */
  if (between < 1) {
    text_fail(t, "%d stations leave no room for the curvature: at most %d in all", m->n_station, FB_MAX_STATIONS);
    return;
  }
  s = m->desc.station;
  for (int k = 0; k < (n > 1 ? n - 1 : 1); k++) {
    const double a = n > 1 ? (double)given[k].x : 0.0, b = n > 1 ? (double)given[k + 1].x : all;
    for (int j = b > a ? k > 0 : between; j <= between; j++) {
      exact_section_at(&s[at], given, n, j == between ? b : a + (b - a) * j / between);
      curve_curvature(&m->curve, (double)s[at].x, s[at].curvature);
      at++;
    }
  }
  memcpy(s + at, given + n, sizeof *s * (size_t)others); /* of the branches */
  for (int k = 0; k < m->desc.n_branch; k++) {
    m->desc.branch[k].station += m->desc.branch[k].n_station > 0 ? at - n : 0;
  }
  s[at - 1].x = (fb_real)all;
  m->desc.n_station = at;
  m->n_station = at + others;
  m->desc.length = (fb_real)all;
}

/* Components that are held at a node. */
static int exact_held(const exact_text *m, int node)
{
  int held = node == m->desc.n_element ? m->desc.tip : 0;
  for (int k = 0; k < m->desc.n_support; k++) {
    held |= m->desc.support[k].node == node ? m->desc.support[k].held : 0;
  }
  return held & FB_END_CLAMPED;
}

/* A node whose support is moved by x: it is one beyond the root, held in what it is moved along. */
static void exact_check_move(text_file *t, const exact_text *m, int node, const double x[6])
{
  static const char *const axes[6] = {"x", "y", "z", "rx", "ry", "rz"};
  const int held = exact_held(m, node);
  if (node == 0) {
    text_fail(t, "the root is held by its base: `position` places it, motion of the base moves it");
  } else if (held == 0) {
    text_fail(t, "nothing holds the beam there: a line `support X END` or `tip END` does");
  }
  for (int i = 0; i < 6; i++) {
    if (x[i] != 0 && !(held >> i & 1)) {
      text_fail(t, "%s is not held there and cannot be moved: hold it, or 0", axes[i]);
    }
  }
}

/* The node of a line that moves a support; refusals name that line. */
static void exact_move_place(text_file *t, exact_text *m, int k)
{
  fb_support_place *const place = &m->input.support[k];
  const int line = t->line;
  exact_spot at = m->move_at[k];
  double x[6];
  for (int i = 0; i < 3; i++) {
    x[i] = (double)place->displacement[i];
    x[i + 3] = (double)place->rotation[i];
  }
  t->line = m->move_line[k];
  at.x = at.x < HUGE_VAL ? at.x : exact_length(m, at.on); /* tip */
  place->node = exact_nearest(t, m, &at, "a support that is moved");
  for (int j = 0; j < k; j++) {
    if (m->input.support[j].node == place->node) {
      text_fail(t, "line %d moves what holds the beam there already", m->move_line[j]);
    }
  }
  exact_check_move(t, m, place->node, x);
  t->line = line;
}

/* Places to nodes, now that length and elements are known. */
static void exact_places(text_file *t, exact_text *m)
{
  if (m->curve.n > 0) {
    exact_curve_begin(t, m);
  }
  if (!(m->desc.length > 0)) {
    text_fail(t, "length is missing, or not positive");
    return;
  }
  if (m->desc.n_station == 0) {
    text_fail(t, "no station");
    return;
  }
  m->desc.n_joint = m->n_joint;
  for (int on = 0; on <= m->desc.n_branch; on++) {
    exact_joints(t, m, on);
  }
  if (m->n_all > FB_MAX_EXACT) {
    text_fail(t, "elements%s are more than %d", m->n_joint + m->desc.n_branch > 0 ? ", joints and branches" : "",
              FB_MAX_EXACT);
    return;
  }
  m->input.n_load = m->n_load;
  m->desc.n_support = m->n_support;
  m->desc.n_lump = m->n_lump;
  for (int k = 0; k < m->n_load; k++) {
    m->input.load[k].node = exact_nearest(t, m, &m->load_at[k], "a load");
  }
  for (int k = 0; k < m->n_support; k++) {
    m->desc.support[k].node = exact_nearest(t, m, &m->support_at[k], "a support");
  }
  m->input.n_support = m->n_move;
  for (int k = 0; k < m->n_move; k++) {
    exact_move_place(t, m, k);
  }
  for (int k = 0; k < m->n_lump; k++) {
    m->desc.lump[k].node = exact_nearest(t, m, &m->lump_at[k], "a lump");
  }
  for (int l = 0; l < m->n_line; l++) {
    exact_line_load(t, m, l);
  }
  exact_doubt(m);
  if (m->curve.n > 0 && !t->failed) {
    exact_curve_stations(t, m);
  }
}

/* [N] Tension that element k bears, 12 EI/h^2 of a straight one (fb_exact_desc.n_element): of its flexibility across by
   E10.6 the softer one. */
static double exact_bears(const fb_exact *exact, int k)
{
  const double y = (double)(exact->C[36 * k + 7] - exact->section[36 * k + 7]);
  const double z = (double)(exact->C[36 * k + 14] - exact->section[36 * k + 14]);
  return fmax(y, z) > 0 ? (double)exact->force / fmax(y, z) : HUGE_VAL;
}

/* Says of the element whose tension is furthest beyond that; 0, and an empty text: none is. */
static inline int exact_overstretched(char text[160], const fb_exact *exact, const fb_exact_state *state)
{
  double most = 1;
  text[0] = '\0';
  for (int k = 0; k < exact->n; k++) {
    fb_exact_element element;
    if (fb_exact_element_eval(exact, &element, state, k) == FB_OK &&
        (double)element.force[0] > most * exact_bears(exact, k)) {
      most = (double)element.force[0] / exact_bears(exact, k);
      snprintf(text, 160,
               "wrong, as element %d has a tension of %.4g and bears 12 EI/h^2 = %.4g: more elements, or more EI", k,
               (double)element.force[0], exact_bears(exact, k));
    }
  }
  return text[0] != '\0';
}
#endif
