/* code_acts.h - what acts on a tree at an instant: the members of its input, and loads at nodes, a force and a torque each,
   body axes, on the deformed body (E8.15). Part of code_tree.h. */
#ifndef CODE_ACTS_H
#define CODE_ACTS_H

enum { TREE_VALUE = 3, TREE_RATE, TREE_MODAL, TREE_AT_NODES = 7, TREE_INPUTS = TREE_AT_NODES + 2 * FB_MAX_NODES };

static const struct {
  const char *name, *what;
} tree_inputs[TREE_AT_NODES] = {
    {"force", "[N] at O, body axes"},
    {"torque", "[N m]"},
    {"motor", "[N m], [N] of each axis, on the body and back on its parent"},
    {"value", "[rad], [m] of its axis, which is prescribed"},
    {"rate", "[rad/s], [m/s]"},
    {"modal", "generalized forces of the modes"},
    {"rotor_motor", "[N m] on each rotor, and back on the body; [N m s] where its momentum is given"}};

/* How many numbers of that kind act on the joint of a loop. */
static int rows_input_size(const fb_joint *joint, int m)
{
  const int driven = tree_count(joint, FB_AXIS_PRESCRIBED) > 0;
  return driven && (m == TREE_RATE || (m == TREE_VALUE && joint->kind != FB_JOINT_SPHERICAL)) ? joint->n_axis : 0;
}

/* How many numbers of that kind act on link k, or on the joint of a loop behind them. */
static int tree_input_size(int k, int m)
{
  const tree_link *const L = &tree.link[k < tree.n ? k : 0];
  const int valued = tree_is_valued(L) ? L->axes : 0, rated = L->driven > 0 ? L->axes : 0;
  const int size[TREE_AT_NODES] = {3, 3, tree_momenta_of(L), valued, rated, L->n, L->model->n_rotor};
  if (k >= tree.n) {
    return rows_input_size(&tree.system->joint[k], m);
  }
  if (m >= TREE_AT_NODES) { /* force and torque of each node but O */
    const int node = (m - TREE_AT_NODES) / 2;
    return node > 0 && tree.choice->loads[k] >> node & 1u ? 3 : 0;
  }
  return (tree.quiet && (m < 2 || m == TREE_MODAL)) || (tree.choice->traced && m == TREE_MODAL) ? 0 : size[m];
}

static const char *tree_input_name(int m)
{
  static char name[24];
  snprintf(name, sizeof name, m % 2 == TREE_AT_NODES % 2 ? "force_%d" : "torque_%d", (m - TREE_AT_NODES) / 2);
  return m < TREE_AT_NODES ? tree_inputs[m].name : name;
}

static const char *tree_input_what(int m)
{
  static char what[32];
  snprintf(what, sizeof what, m % 2 == TREE_AT_NODES % 2 ? "[N] at node %d, body axes" : "[N m]",
           (m - TREE_AT_NODES) / 2);
  return m < TREE_AT_NODES ? tree_inputs[m].what : what;
}

/* A load at a node of link k, added to that about O, F, and to the rates of the modes. */
static void acts_write_node(const code *w, code_value F[6], int k, int at)
{
  static rows_end end;
  const tree_link *const L = &tree.link[k];
  const code_value name = code_variable("p%d_%d", k, at);
  code_value force[3], torque[3];
  code_sum s;
  if (L->model->node[at].line.line > 0) {
    code own = tree_enter(w, k);
    own.indent = w->indent;
    large_write_hold(&own, k, at);
    tree_leave(k);
  }
  rows_write_node(w, &end, k, at, name);
  for (int i = 0; i < 6; i++) {
    code_value *const x = i < 3 ? &force[i] : &torque[i - 3];
    *x = code_variable("%s%c%c", name.name, i < 3 ? 'f' : 't', tree_axis[i % 3]);
    fprintf(w->out, "%*sconst %s %s = in->body_%d.%s_%d[%d];\n", w->indent, "", code_real(w), x->name, k,
            i < 3 ? "force" : "torque", at, i % 3);
  }
  for (int i = 0; i < 6; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, F[i]);
    code_add_one(&s, 1.0, i < 3 ? force[i] : torque[i - 3]);
    if (i >= 3) {
      tree_add_cross(&s, 1.0, end.n, force, i - 3);
    }
    F[i] = code_end(w, &s, code_variable("%sF%s", name.name, code_rows[i]));
  }
  for (int a = 0; a < L->n && end.moves; a++) {
    char target[32];
    snprintf(target, sizeof target, "rate[%d]", L->pi + a);
    code_begin(&s);
    code_add_one(&s, 1.0, code_variable("%s", target));
    for (int i = 0; i < 3; i++) {
      code_add(&s, 1.0, end.Ju[a][i], force[i]);
      code_add(&s, 1.0, end.Jphi[a][i], torque[i]);
    }
    code_assign(w, &s, target);
  }
}

static void acts_write_nodes(const code *w, code_value F[6], int k)
{
  for (int at = 1; at < tree.link[k].model->n_node; at++) {
    if (tree.choice->loads[k] >> at & 1u) {
      acts_write_node(w, F, k, at);
    }
  }
}
#endif
