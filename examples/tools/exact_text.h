/* exact_text.h - text descriptions of a geometrically exact beam, read into a fb_exact_desc and what acts on it.
   README.md lists the words. Include flexbeam.h first. */
#ifndef EXACT_TEXT_H
#define EXACT_TEXT_H
#include "../common/text.h"

typedef struct exact_text { /* what was read; places want the whole file before they can be used */
  fb_exact_desc desc;
  fb_exact_input input;
  int modes, station_open;
  int n_load, n_line, n_support, n_lump, n_joint;
  double load_at[FB_MAX_LOADS], support_at[FB_MAX_LUMPS], lump_at[FB_MAX_LUMPS], joint_at[FB_MAX_LUMPS];
  int elements, joint_node[FB_MAX_LUMPS]; /* without joints */
  struct {
    double a, b;
    fb_line_load load;
  } line[64];
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
  fb_exact_station *const s = &m->desc.station[m->desc.n_station > 0 ? m->desc.n_station - 1 : 0];
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
  if (m->desc.n_station == FB_MAX_STATIONS) {
    text_fail(t, "more than %d stations", FB_MAX_STATIONS);
    return;
  }
  if (m->desc.n_station > 0) { /* what is not given is that of the station before */
    m->desc.station[m->desc.n_station] = m->desc.station[m->desc.n_station - 1];
  }
  m->desc.station[m->desc.n_station++].x = (fb_real)text_number(t, "x of the station");
  m->station_open = 1;
}

static void exact_lump(text_file *t, exact_text *m)
{
  fb_lump *const lump = &m->desc.lump[m->n_lump];
  if (m->n_lump == FB_MAX_LUMPS) {
    text_fail(t, "more than %d lumps", FB_MAX_LUMPS);
    return;
  }
  m->lump_at[m->n_lump++] = text_number(t, "x of the lump");
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
  m->joint_at[m->n_joint] = text_number(t, "x of the joint");
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

/* Loads, supports, lumps and joints, which name places; 0 if it is none of them. */
static int exact_place(text_file *t, exact_text *m, const char *word)
{
  if (strcmp(word, "load") == 0) {
    fb_load *const load = &m->input.load[m->n_load];
    if (m->n_load == FB_MAX_LOADS) {
      text_fail(t, "more than %d loads", FB_MAX_LOADS);
      return 1;
    }
    m->load_at[m->n_load++] = text_number(t, "x of the load");
    load->axes = exact_axes(t);
    exact_force(t, load->force, load->torque);
  } else if (strcmp(word, "line") == 0) {
    if (m->n_line == 64) {
      text_fail(t, "more than 64 line loads");
      return 1;
    }
    m->line[m->n_line].a = text_number(t, "begin of the line load");
    m->line[m->n_line].b = text_number(t, "end of the line load");
    m->line[m->n_line].load.axes = exact_axes(t);
    exact_force(t, m->line[m->n_line].load.force, m->line[m->n_line].load.torque);
    m->n_line++;
  } else if (strcmp(word, "support") == 0) {
    if (m->n_support == FB_MAX_LUMPS) {
      text_fail(t, "more than %d supports", FB_MAX_LUMPS);
      return 1;
    }
    m->support_at[m->n_support] = text_number(t, "x of the support");
    m->desc.support[m->n_support++].held = exact_end(t);
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

/* A line that begins with that word. */
static void exact_line(text_file *t, exact_text *m, const char *word)
{
  if (strcmp(word, "length") == 0) {
    m->desc.length = (fb_real)text_number(t, word);
  } else if (strcmp(word, "elements") == 0) {
    m->desc.n_element = text_whole(t, word, 1, FB_MAX_EXACT);
  } else if (strcmp(word, "station") == 0) {
    exact_station_line(t, m);
  } else if (strcmp(word, "position") == 0) {
    text_reals(t, word, m->desc.position, 3);
  } else if (strcmp(word, "attitude") == 0) {
    fb_real turn[3];
    for (int i = 0; i < 3; i++) {
      turn[i] = (fb_real)text_degrees(t, "attitude x y z");
    }
    fb_quat_from_rotvec(m->desc.attitude, turn);
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
  } else if (!exact_section(t, m, word) && !exact_place(t, m, word)) {
    text_fail(t, "no such word for an exact beam: %s", word);
  }
  text_end_of_line(t);
}

/* Joints inboard of the beam's own node. */
static int exact_joints_before(const exact_text *m, int node)
{
  int n = 0;
  for (int k = 0; k < m->desc.n_joint; k++) {
    n += m->joint_node[k] < node;
  }
  return n;
}

/* Nearest node; where joints are, the one inboard of them. */
static int exact_nearest(text_file *t, const exact_text *m, double x, const char *what)
{
  const double L = (double)m->desc.length;
  int node;
  if (!(x >= -1e-9 * L && x <= L * (1 + 1e-9))) {
    text_fail(t, "%s at %g is not on the beam", what, x);
    return 0;
  }
  node = (int)lround(x / L * m->elements);
  return node + exact_joints_before(m, node);
}

/* Place of a node. */
static inline double exact_node_place(const exact_text *m, int node)
{
  int before = 0;
  for (int k = 0; k < m->desc.n_joint; k++) {
    before += m->desc.joint[k].element < node;
  }
  return (double)m->desc.length * (node - before) / m->elements;
}

static int exact_is_joint(const exact_text *m, int element)
{
  int is = 0;
  for (int k = 0; k < m->desc.n_joint; k++) {
    is = is || m->desc.joint[k].element == element;
  }
  return is;
}

/* Joints become elements between those that the file counts. */
static void exact_joints(text_file *t, exact_text *m)
{
  m->elements = m->desc.n_element;
  for (int k = 0; k < m->n_joint; k++) {
    m->joint_node[k] = exact_nearest(t, m, m->joint_at[k], "a joint");
  }
  if (m->elements + m->n_joint > FB_MAX_EXACT) {
    text_fail(t, "elements and joints are more than %d", FB_MAX_EXACT);
    return;
  }
  m->desc.n_joint = m->n_joint;
  m->desc.n_element += m->n_joint;
  for (int k = 0; k < m->n_joint; k++) {
    int *const element = &m->desc.joint[k].element;
    *element = m->joint_node[k];
    for (int j = 0; j < m->n_joint; j++) {
      *element += m->joint_node[j] < m->joint_node[k] || (j < k && m->joint_node[j] == m->joint_node[k]);
    }
  }
}

/* Places to nodes, now that length and elements are known. */
static void exact_places(text_file *t, exact_text *m)
{
  if (!(m->desc.length > 0)) {
    text_fail(t, "length is missing, or not positive");
    return;
  }
  if (m->desc.n_station == 0) {
    text_fail(t, "no station");
    return;
  }
  exact_joints(t, m);
  m->input.n_load = m->n_load;
  m->desc.n_support = m->n_support;
  m->desc.n_lump = m->n_lump;
  for (int k = 0; k < m->n_load; k++) {
    m->input.load[k].node = exact_nearest(t, m, m->load_at[k], "a load");
  }
  for (int k = 0; k < m->n_support; k++) {
    m->desc.support[k].node = exact_nearest(t, m, m->support_at[k], "a support");
  }
  for (int k = 0; k < m->n_lump; k++) {
    m->desc.lump[k].node = exact_nearest(t, m, m->lump_at[k], "a lump");
  }
  for (int l = 0; l < m->n_line; l++) {
    const int a = exact_nearest(t, m, m->line[l].a, "a line load"),
              b = exact_nearest(t, m, m->line[l].b, "a line load");
    if (a >= b) {
      text_fail(t, "a line load from %g to %g covers no element", m->line[l].a, m->line[l].b);
    }
    for (int k = a; k < b && k < m->desc.n_element; k++) {
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
}
#endif
