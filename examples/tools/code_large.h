/* code_large.h - bodies of a tree with lines of large deflection (code_line.h, THEORY.md 14), in the step that
   code_tree.h writes and whose words it uses: the equations of fb_system_rk4_step. Part of code_tree.h.

   The elastic mass M(q) of such a body is not the same at all states: the rates of its coordinates are speeds of the tree,
   like those of modes that move a joint (code_node.h), and so are those of all modes beside it where the step limit asks
   for the largest eigenvalue of all (E11.40). */
#ifndef CODE_LARGE_H
#define CODE_LARGE_H

static struct code_line large_lines[FB_MAX_BODIES][FB_MAX_LINES];
static code_value large_mass[FB_MAX_BODIES][FB_MAX_MODES][FB_MAX_MODES]; /* M(q) */

/* What of bodies with lines is not written by that choice, with the body; "": nothing. */
static inline void large_refusal(char text[200], const fb_system *system, const fb_body *body, const char *const *names,
                                 const tree_choice *choice)
{
  text[0] = '\0';
  for (int k = 0; k < system->n_body && !text[0]; k++) {
    const char *what = choice->lanes      ? "effects large by lanes: choose effects up to full"
                       : choice->implicit ? "effects large by integrator sdirk: choose integrator rk4"
                                          : NULL;
    for (int at = 1; at < FB_MAX_NODES && !what; at++) {
      what = choice->loads[k] >> at & 1u && large_carries(system, body, k, at)
                 ? "loads on a line of effects large: choose effects up to full"
                 : NULL;
    }
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

/* Functions of all lines. 0: there is no temporary file, see errno. */
static int large_write_functions(const code *w)
{
  int good = 1, n = 0;
  for (int k = 0; k < tree.n; k++) {
    if (large_is(tree.link[k].model) && large_of(k) == k) {
      (void)tree_enter(w, k);
      code_of_names = "";
      code_lines_first = n;
      good = code_write_lines(w) && good;
      n += tree.link[k].model->lines.n_line;
    }
  }
  return good;
}

/* E14.12 of body k, which is that of code.h: lines, Lambda, M, M_rr and first moment of mass of the whole at the vector x. */
static void large_write_inertia(const code *own, int k)
{
  const int at = tree.link[k].q;
  code_write_large_poses(own, "x", at);
  code_write_lambda(own);
  code_write_inertia(own);
  code_write_large_inertias(own, "x", at);
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
  fputs("\n  /* E14.7: dT/dq of the lines at fixed V and q_dot */\n", own->out);
  for (int l = 0; l < L->model->lines.n_line; l++) {
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
      y[L->row + a] = x ? x[L->row + a] : code_constant(sqrt(stiff));
      y[L->row + a].c *= x ? stiff : 1.0;
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
    fprintf(w->out, "%s > 0", code_variable("size").name);
    code_template(w, " ? `1` / sqrt~(");
    fprintf(w->out, "%s) : 0;\n", code_variable("size").name);
    for (int i = 0; i < code_solver.n; i++) {
      code_begin(&s);
      code_add(&s, 1.0, code_variable("share"), y[i]);
      y[i] = code_end(w, &s, code_variable("y_%d", i));
    }
  }
  code_of_names = "";
  code_number(number, w, (double)tree.system->limit_elastic);
  code_template(w, "    stiffening += `1.05` * bent > ");
  fprintf(w->out, "%s ? ", number);
  code_template(w, "`1.05` * bent - ");
  fprintf(w->out, "%s : 0;\n", number);
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
