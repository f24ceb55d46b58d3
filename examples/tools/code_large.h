/* code_large.h - bodies of a tree with lines of large deflection (code_line.h, THEORY.md 14), in the step that
   code_tree.h writes and whose words it uses: the equations of fb_system_rk4_step. Part of code_tree.h.

   The elastic mass M(q) of such a body is not the same at all states: the rates of its coordinates are speeds of the tree,
   like those of modes that move a joint (code_node.h), and so are those of all modes beside it where the step limit asks
   for the largest eigenvalue of all (E11.40). */
#ifndef CODE_LARGE_H
#define CODE_LARGE_H

typedef enum large_use { /* what is used of lines: first moments of mass; inertia; and their range */
                         LARGE_POSED,
                         LARGE_MOVING,
                         LARGE_SEEN
} large_use;

static struct code_line large_lines[FB_MAX_BODIES][FB_MAX_LINES];
static code_value large_mass[FB_MAX_BODIES][FB_MAX_MODES][FB_MAX_MODES]; /* M(q) */

/* What of bodies with lines is not written by that choice, with the body; "": nothing. */
static inline void large_refusal(char text[200], const fb_system *system, const fb_body *body, const char *const *names,
                                 const tree_choice *choice)
{
  text[0] = '\0';
  for (int k = 0; k < system->n_body && !text[0]; k++) {
    const char *const what =
        choice->lanes == TREE_LANES_ALONE ? "effects large by a table: choose effects up to full" : NULL;
    if (what && large_is(&body[system->model[k]])) {
      snprintf(text, 200, "%.60s: %s", names[k], what);
    }
  }
}

/* The first link with the model of link k: its lines are those of k. */
static int large_of(int k)
{
  int first = 0;
  while (tree.link[first].model != tree.link[k].model) {
    first++;
  }
  return first;
}

/* The lines of link k become those of code_line.h. */
static void large_enter(int k)
{
  code_lines = large_lines[large_of(k)];
  code_lines_carried = 1;
}

/* Does loop or joint j have a side on that node of link k? */
static int large_is_end(const fb_system *system, int j, int k, int node)
{
  const fb_joint *const joint = &system->joint[j];
  return (joint->kind != FB_JOINT_FREE && joint->parent == k && joint->moves && joint->parent_node == node) ||
         (j >= system->n_body && joint->child == k && joint->child_node == node);
}

/* Bits of the nodes on lines of link k that joints and loops are on; carrying 0: or springs between points. */
static unsigned large_held(int k, int carrying)
{
  const fb_system *const system = tree.system;
  unsigned held = 0;
  for (int at = 1; at < tree.link[k].model->n_node; at++) {
    int is = 0;
    for (int j = 0; j < system->n_body + system->n_loop; j++) {
      is |= large_is_end(system, j, k, at);
    }
    for (int j = 0; j < system->n_spring && !carrying; j++) {
      for (int side = 0; side < 2; side++) {
        is |= system->spring[j].body[side] == k && system->spring[j].node[side] == at;
      }
    }
    held |= is && tree.link[k].model->node[at].line.line > 0 ? 1u << at : 0u;
  }
  return held;
}

/* What code_line.h writes of the lines of link k: of all links with its model. */
static void large_hold(int k)
{
  code_held = code_carrying = 0;
  for (int j = 0; j < tree.n; j++) {
    if (large_of(j) == k) {
      code_held |= large_held(j, 0) | tree.choice->loads[j];
      code_carrying |= large_held(j, 1);
    }
  }
}

/* Finds node `at` of link k, whose body is that of code.h and whose lines are known. */
static void large_write_hold(const code *own, int k, int at)
{
  const int l = tree.link[k].model->node[at].line.line - 1;
  char name[24];
  snprintf(name, sizeof name, "hold_%d", at);
  fprintf(own->out, "%*s", own->indent, "");
  code_write_large_call(own, name, l);
  fprintf(own->out, ", x + %d);\n", tree.link[k].q + tree.link[k].model->lines.line[l].first);
}

/* Functions of all lines. 0: there is no temporary file, see errno. */
static int large_write_functions(const code *w)
{
  int good = 1, n = 0;
  for (int k = 0; k < tree.n; k++) {
    if (large_is(tree.link[k].model) && large_of(k) == k) {
      (void)tree_enter(w, k);
      code_of_names = "";
      code_lines_first = n;
      large_hold(k);
      good = code_write_lines(w) && good;
      n += tree.link[k].model->lines.n_line;
    }
  }
  return good;
}

/* Poses and inertia of all lines, and their nodes that carry something but loads, as far as they are used. */
static void large_write_lines(const code *w, large_use use)
{
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    if (large_is(L->model)) {
      const code own = tree_enter(w, k);
      unsigned held;
      large_hold(large_of(k));
      held = large_held(k, 0) | code_carrying; /* of which the gradient asks, whoever of its model it is */
      code_write_large_poses(&own, "x", L->q);
      if (use != LARGE_SEEN) {
        fprintf(w->out, "  (void)b%d_sound;\n", k);
      }
      if (use >= LARGE_MOVING || held) {
        code_write_large_inertias(&own, "x", L->q);
      }
      for (int at = 1; at < L->model->n_node; at++) {
        if (held >> at & 1u) {
          large_write_hold(&own, k, at);
        }
      }
      tree_leave(k);
    }
  }
}

/* E14.12 of body k, which is that of code.h, whose lines are known: Lambda, M, M_rr and first moment of mass of the whole at the vector x. */
static void large_write_inertia(const code *own, int k)
{
  code_write_lambda(own);
  code_write_inertia(own);
  code_write_large_inertia(own);
  for (int a = 0; a < own->n; a++) {
    for (int b = a; b < own->n; b++) {
      large_mass[k][a][b] = large_mass[k][b][a] = code_write_large_mass(own, a, b);
    }
  }
}

/* The same of link k, with its rotors. */
static void large_write_body(const code *w, int k)
{
  tree_link *const L = &tree.link[k];
  const code own = tree_enter(w, k);
  fprintf(w->out, "\n  /* body %d, %s: E14.12 */\n", k, tree.names[k]);
  large_write_inertia(&own, k);
  tree_write_rotors(&own, k);
  memcpy(tree_nodes[k].M_rr, code_now.S, sizeof tree_nodes[k].M_rr);
  tree_write_spin(&own, k);
  tree_leave(k);
  memcpy(L->I, tree_nodes[k].M_rr, sizeof L->I);
  memcpy(L->b, tree_nodes[k].spin, sizeof L->b);
}

/* First moment of mass of body k, which is that of code.h, whose lines are posed; that of the rest is known. */
static code_value large_write_center(const code *own, int i, int k)
{
  code_sum s;
  code_begin(&s);
  code_add_one(&s, 1.0, code_now.value[i]);
  for (int l = 0; l < tree.link[k].model->lines.n_line; l++) {
    code_add_one(&s, 1.0, code_write_large_center(own, "x", tree.link[k].q, l, i));
  }
  return code_end(own, &s, code_variable("all_c_%c", tree_axis[i]));
}

/* Refusal where an interval of a line turns too far. */
static void large_write_range(const code *w)
{
  int n = 0;
  for (int k = 0; k < tree.n; k++) {
    if (large_is(tree.link[k].model)) {
      fprintf(w->out, n++ ? " & b%d_sound" : "  if (!(b%d_sound", k);
    }
  }
  code_template(w, n ? ")) {\n    return @_is_finite(x, @_N) ? @_range : @_not_finite;\n  }\n" : "");
}

/* The same at the end of a step, the sums d. */
static void large_write_end(const code *w, int k)
{
  if (large_is(tree.link[k].model)) {
    const code own = tree_enter(w, k);
    code_write_large_poses(&own, "d", tree.link[k].q);
    tree_leave(k);
    code_template(w, "  status = status == @_ok && !");
    fprintf(w->out, "b%d_sound", k);
    code_template(w, " ? @_range : status;\n");
  }
}

/* s += momentum i about a node of link k of all that it carries. */
static void large_add_momentum(code_sum *s, double c, int k, int at, int i)
{
  const fb_system *const system = tree.system;
  for (int j = 0; j < system->n_body + system->n_loop; j++) {
    if (large_is_end(system, j, k, at)) {
      const rows_loop *const loop = &constraint.loop[j - system->n_body];
      code_add_one(s, c,
                   j < system->n_body ? tree_nodes[j].end.G[i]
                   : loop->end[0].link == k && loop->joint->parent_node == at && loop->joint->moves
                       ? loop->end[0].G[i]
                       : loop->end[1].G[i]);
    }
  }
}

/* The momenta of all that line l of body k carries, line axes. */
static void large_write_momenta(const code *own, int k, int l)
{
  const code_value name = code_variable("held_%d", l);
  int n = 0;
  if (code_lines[l].carries == 0) {
    return;
  }
  code_line = code_lines[l];
  large_hold(large_of(k));
  code_template(own, "  $ ");
  fprintf(own->out, "%s[%d];\n", name.name, 6 * code_lines[l].carries);
  for (int at = code_hold_next(code_carrying, 1); at >= 0; at = code_hold_next(code_carrying, at + 1)) {
    for (int i = 0; i < 6; i++, n++) {
      code_sum s;
      code_begin(&s);
      for (int j = 0; j < 3; j++) {
        large_add_momentum(&s, code_large_axes(l, j, i % 3), k, at, i - i % 3 + j);
      }
      code_assign(own, &s, code_plain("%s[%d]", name.name, n).name);
    }
  }
}

/* Node `at` of link k on a line: n, N, Ju and Jphi of code_rows.h. */
static void large_write_node(const code *w, rows_end *end, int k, int at, code_value name)
{
  const fb_body *const body = tree.link[k].model;
  const int l = body->node[at].line.line - 1;
  const fb_line *const line = &body->lines.line[l];
  code_value C[9], H[9], T[9];
  code_sum s;
  (void)tree_enter(w, k);
  code_of_names = "";
  for (int i = 0; i < 9; i++) {
    C[i] = code_constant(code_large_axes(l, i / 3, i % 3));
    H[i] = code_plain("b%d_line_%d.h%d_H[%d]", k, l, at, i);
  }
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    for (int j = 0; j < 3; j++) {
      code_add(&s, 1.0, C[3 * i + j], code_plain("b%d_line_%d.h%d_r[%d]", k, l, at, j));
    }
    end->n[i] = code_end(w, &s, code_plain("%sn%c", name.name, tree_axis[i]));
  }
  for (int i = 0; i < 9; i++) {
    code_begin(&s);
    for (int j = 0; j < 3; j++) {
      code_add(&s, 1.0, C[i / 3 * 3 + j], H[3 * j + i % 3]);
    }
    T[i] = code_end(w, &s, code_plain("%sT%d", name.name, i));
  }
  for (int i = 0; i < 9; i++) {
    code_begin(&s);
    for (int j = 0; j < 3; j++) {
      code_add(&s, 1.0, T[i / 3 * 3 + j], C[i % 3 * 3 + j]);
    }
    end->N[i] = code_end(w, &s, code_plain("%sN%d", name.name, i));
  }
  for (int a = 0; a < body->n; a++) {
    for (int i = 0; i < 6; i++) {
      code_begin(&s);
      for (int j = 0; j < 3 && a >= line->first && a < line->first + line->n; j++) {
        code_add(&s, 1.0, C[i % 3 * 3 + j],
                 code_plain("b%d_line_%d.h%d_J[%d]", k, l, at, 6 * (a - line->first) + i - i % 3 + j));
      }
      (i < 3 ? end->Ju : end->Jphi)[a][i % 3] = code_end(w, &s, code_plain("%sJ%d_%d", name.name, a, i));
    }
  }
  tree_leave(k);
}

/* Force on the coordinates of body k, which is that of code.h, by the inertia of its lines (E14.7). */
static void large_write_gradient(const code *own, code_sum *force, int k)
{
  const tree_link *const L = &tree.link[k];
  code_sum s;
  for (int a = 0; a < own->n; a++) {
    code_begin(&s);
    code_add_one(&s, 1.0, code_now.q_dot[a]);
    code_assign(own, &s, code_plain("rate[%d]", L->q + a).name);
  }
  fputs("\n  /* E14.7: dT/dq of the lines at fixed V and q_dot, E9.25 of what they carry */\n", own->out);
  for (int l = 0; l < L->model->lines.n_line; l++) {
    large_write_momenta(own, k, l);
    code_write_large_line(own, L->q, l);
  }
  for (int a = 0; a < own->n; a++) {
    code_add_one(&force[a], 1.0, code_large_gradient(a));
  }
}

/* ---- the step limit */

/* y = A x, stiffness of modes and axes, in the rows of the matrix; x NULL: the impulses that E11.40 begins with. */
static void large_write_stiffness(const code *w, code_value y[CODE_ROWS], const code_value *x, const char *name)
{
  static double K[FB_MAX_MODES][FB_MAX_MODES], C[FB_MAX_MODES][FB_MAX_MODES];
  code_sum s;
  tree_nothing(y, CODE_ROWS);
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    for (int a = 0; a < L->axes; a++) {
      const double stiff = (double)L->joint->stiffness[a] + (double)L->joint->stop_stiffness[a];
      const int row = L->row[a];
      if (tree_is_free(L, a)) {
        y[row] = x ? x[row] : code_constant(sqrt(stiff));
        y[row].c *= x ? stiff : 1.0;
      }
    }
    code_read_springs(K, C, L->model);
    for (int a = 0; a < L->n; a++) {
      const double sign = (7 * k + 3 * a) % 5 < 2 ? -1.0 : 1.0;
      code_begin(&s);
      code_add_one(&s, x || !(K[a][a] > 0.0) ? 0.0 : sign * sqrt(K[a][a]), code_constant(1.0));
      for (int b = 0; b < L->n && x; b++) {
        code_add_one(&s, K[a][b], x[L->mode_row + b]);
      }
      y[L->mode_row + a] = code_end(w, &s, code_variable("%s%d", name, L->mode_row + a));
    }
  }
}

/* x of M x = y by the factors at hand, y by rows. */
static void large_write_solve(const code *w, code_value x[CODE_ROWS], const code_value y[CODE_ROWS])
{
  static char names[CODE_ROWS][CODE_NAME];
  code_factor *const f = &code_solver;
  for (int i = 0; i < f->n; i++) {
    snprintf(names[i], CODE_NAME, "u_%d", tree_solved[i]);
    f->y[i] = y[tree_solved[i]];
  }
  code_write_substitution(w, f, names);
  for (int i = 0; i < f->n; i++) {
    x[tree_solved[i]] = f->x[i];
  }
}

/* E11.40: the power method. */
static void large_write_bent(const code *w)
{
  static char prefix[16];
  code_value x[CODE_ROWS], y[CODE_ROWS];
  char number[40];
  large_write_stiffness(w, y, NULL, "y");
  for (int step = 0; step < 4; step++) {
    code_sum size, s;
    snprintf(prefix, sizeof prefix, "t%d", step);
    code_of_names = prefix;
    large_write_solve(w, x, y);
    code_begin(&size);
    if (step == 3) {
      for (int i = 0; i < code_solver.n; i++) {
        code_add(&size, 1.0, y[i], x[i]);
      }
      code_of_names = "";
      code_declare(w, &size, "bent");
      break;
    }
    large_write_stiffness(w, y, x, "K");
    for (int i = 0; i < code_solver.n; i++) {
      code_add(&size, 1.0, y[i], x[i]);
    }
    code_declare(w, &size, code_variable("size").name);
    fprintf(w->out, "    const %s %s = ", code_real(w), code_variable("share").name);
    code_template(w, "%W");
    fprintf(w->out, "%s > 0", code_variable("size").name);
    code_template(w, "%, `1` / sqrt~(");
    fputs(code_variable("size").name, w->out);
    code_template(w, ")%!;\n");
    for (int i = 0; i < code_solver.n; i++) {
      code_begin(&s);
      code_add(&s, 1.0, code_variable("share"), y[i]);
      y[i] = code_end(w, &s, code_variable("y_%d", i));
    }
  }
  code_of_names = "";
  code_number(number, w, (double)tree.system->limit_elastic);
  code_template(w, "    stiffening += %W`1.05` * bent > ");
  fputs(number, w->out);
  code_template(w, "%, `1.05` * bent - ");
  fputs(number, w->out);
  code_template(w, "%!;\n");
}

/* What lines add to the bound of E11.15: the fastest rotation of a section, the stiffness at this deflection. */
static void large_write_limit(const code *w)
{
  if (!large_any(tree.system, tree.body)) {
    return;
  }
  code_template(w, "    $ section = %z;\n");
  for (int k = 0; k < tree.n; k++) {
    if (large_is(tree.link[k].model)) {
      const code own = tree_enter(w, k);
      code_write_large_fastest(&own, "section");
      tree_leave(k);
    }
  }
  code_template(w, "    fastest += sqrt~(section);\n");
  fputs("\n    /* E11.40 */\n", w->out);
  large_write_bent(w);
}
#endif
