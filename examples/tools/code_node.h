/* code_node.h - joints on nodes that modes move, in the step that code_tree.h writes and whose words it uses: the
   equations of fb_system_rk4_step. Part of code_tree.h.

   The rates of modes that move such a node are speeds of the tree like those of axes: each turns and moves what hangs
   on the node by a twist Phi_a = (J_u,a + n x J_phi,a, J_phi,a) about O of the body, its axes, as if axes lay between
   the body and the child. They are therefore rows of the matrix of the speeds, with M_aa' of the body and Lambda of it
   on the axes further in, and not eliminated within the body: it has its M_rr in place of S. */
#ifndef CODE_NODE_H
#define CODE_NODE_H

/* ---- places */

/* Joint's axes D on the parent and its origin `at` there. */
static void node_write_frame(const code *w, int k)
{
  tree_link *const L = &tree.link[k];
  struct tree_node *const node = &tree_nodes[k];
  const code_value name = code_variable("n%d", k);
  code_value axes[9], own[3];
  code_sum s;
  tree_constants(L->D, L->joint->axes, 9);
  for (int i = 0; i < 3; i++) {
    L->at[i] = code_constant((double)L->joint->position[i]);
  }
  if (!L->moves) {
    return;
  }
  fprintf(w->out, "\n  /* E8.14: the node that carries body %d */\n", k);
  rows_unit(node->end.N);
  rows_write_node(w, &node->end, L->parent, L->joint->parent_node, name);
  memcpy(axes, L->D, sizeof axes);
  memcpy(own, L->at, sizeof own);
  rows_write_product(w, L->D, node->end.N, 0, axes, code_variable("n%d_D", k));
  rows_write_turned(w, L->at, node->end.N, 0, own, node->end.n, code_variable("n%d_o", k));
  for (int a = 0; a < tree.link[L->parent].n; a++) {
    for (int i = 0; i < 3; i++) {
      code_begin(&s);
      code_add_one(&s, 1.0, node->end.Ju[a][i]);
      tree_add_cross(&s, 1.0, node->end.n, node->end.Jphi[a], i);
      node->twist[a][i] = code_end(w, &s, code_variable("n%d_P%d%c", k, a, tree_axis[i]));
      node->twist[a][3 + i] = node->end.Jphi[a][i];
    }
  }
}

/* Places of all links; lines: what of lines is used. */
static void tree_write_places(const code *w, large_use lines)
{
  large_write_lines(w, lines);
  for (int k = 0; k < tree.n; k++) {
    node_write_frame(w, k);
    tree_write_place(w, k);
  }
}

/* ---- bodies by themselves */

/* M_rr of an open body in place of S; of it only rotors have momentum at rest. */
static void node_write_body(const code *w, int k)
{
  tree_link *const L = &tree.link[k];
  code_value *const M = tree_nodes[k].M_rr;
  const code own = tree_enter(w, k);
  code_sum s;
  for (int i = 0; i < 6 && code_model.constant_S; i++) {
    char name[CODE_NAME];
    snprintf(name, sizeof name, "T_%s", code_rows[i]);
    code_write_solve(&own, code_now.turned[i], code_now.lambda[i], name);
  }
  for (int e = 0; e < 21; e++) {
    const int i = fbi_sym6_row[e], j = fbi_sym6_column[e];
    double size = 0.0;
    for (int m = 0; m < code_model.n_part[e]; m++) {
      code_write_value(&own, code_model.part[e][m]);
    }
    code_begin(&s);
    for (int m = 0; m < code_model.n_part[e]; m++) {
      code_add_one(&s, code_model.sign[e][m], code_now.value[code_model.part[e][m]]);
    }
    if (code_model.constant_S) {
      code_add_one(&s, 1.0, code_now.S[e]);
      size = sqrt(fabs(code_now.S[fb_sym6_index(i, i)].c * code_now.S[fb_sym6_index(j, j)].c));
    }
    for (int a = 0; a < L->n && code_model.constant_S; a++) {
      code_add(&s, 1.0, code_now.lambda[i][a], code_now.turned[j][a]);
      size += fabs(code_now.lambda[i][a].c * code_now.turned[j][a].c);
    }
    M[e] = code_end(&own, &s, code_variable("N_%s_%s", code_rows[i], code_rows[j]));
    if (code_is_constant(&M[e]) && fabs(M[e].c) <= 64.0 * DBL_EPSILON * size) {
      M[e] = code_constant(0.0);
    }
  }
  tree_write_spin(&own, k);
  tree_leave(k);
  memcpy(L->I, M, sizeof L->I);
  memcpy(L->b, tree_nodes[k].spin, sizeof L->b);
}

static void tree_write_bodies(const code *w)
{
  for (int k = 0; k < tree.n; k++) {
    if (large_is(tree.link[k].model)) {
      large_write_body(w, k);
      continue;
    }
    tree_write_body(w, k);
    if (tree.link[k].open) {
      node_write_body(w, k);
    }
  }
}

/* ---- what is passed on to the parent */

/* y of the parent += x of link k; by a node that modes move also to `passed`. */
static void tree_write_pass(const code *w, code_value y[6], const code_value x[6], const char *name, int k)
{
  const tree_link *const L = &tree.link[k];
  code_value *const passed = tree_nodes[k].passed;
  if (!L->moves) {
    tree_write_to_parent(w, y, L, x, name, k);
    return;
  }
  tree_nothing(passed, 6);
  tree_write_to_parent(w, passed, L, x, name, k);
  for (int i = 0; i < 6; i++) {
    code_sum s;
    code_begin(&s);
    code_add_one(&s, 1.0, y[i]);
    code_add_one(&s, 1.0, passed[i]);
    y[i] = code_end(w, &s, code_variable("b%d_%sy_%s", k, name, code_rows[i]));
  }
}

/* s += what it does to mode a of the parent */
static void node_add_passed(code_sum *s, double sign, int k, int a)
{
  for (int i = 0; i < 6 && tree.link[k].moves; i++) {
    code_add(s, sign, tree_nodes[k].twist[a][i], tree_nodes[k].passed[i]);
  }
}

/* target[at of mode a of the parent] += sign times what was passed on does to it. */
static void node_write_passed(const code *w, const char *of, double sign, int k)
{
  const tree_link *const L = &tree.link[k];
  char target[40];
  code_sum s;
  for (int a = 0; L->moves && a < tree.link[L->parent].n; a++) {
    snprintf(target, sizeof target, "%s[%d]", of, tree.link[L->parent].pi + a);
    code_begin(&s);
    node_add_passed(&s, sign, k, a);
    if (s.n > 0 || fabs(s.constant) > 0.0) {
      code_add_one(&s, 1.0, code_variable("%s", target));
      code_assign(w, &s, target);
    }
  }
}

/* E9.3 of a link, by a node that modes move also by itself, and its momentum at rest. */
static void node_write_inertia(const code *w, int k)
{
  code_value *const I = tree.link[tree.link[k].parent].I, before[21];
  struct tree_node *const node = &tree_nodes[k];
  if (!tree.link[k].moves) {
    tree_write_inertia(w, k);
  } else {
    memcpy(before, I, sizeof before);
    tree_nothing(I, 21);
    tree_write_inertia(w, k);
    memcpy(node->I, I, sizeof before);
    for (int e = 0; e < 21; e++) {
      const char *const row = code_rows[fbi_sym6_row[e]], *const column = code_rows[fbi_sym6_column[e]];
      code_sum s;
      code_begin(&s);
      code_add_one(&s, 1.0, before[e]);
      code_add_one(&s, 1.0, node->I[e]);
      I[e] = code_end(w, &s, code_variable("b%d_Y%d_%s_%s", tree.link[k].parent, k, row, column));
    }
  }
  tree_write_pass(w, tree.link[tree.link[k].parent].b, tree.link[k].b, "r", k);
  memcpy(node->rest, node->passed, sizeof node->rest);
}

/* E9.3 from the tips. */
static void tree_write_inertias(const code *w)
{
  fputs("\n  /* E9.3: inertia and momentum at rest of all that hangs on a joint */\n", w->out);
  for (int k = tree.n - 1; k >= 0; k--) {
    if (tree.link[k].parent >= 0) {
      node_write_inertia(w, k);
    }
  }
}

/* ---- velocities */

/* Elements of a column in the rows of the modes that move the node of link k, by its momentum f about O of the parent. */
static void node_write_rows(const code *w, int k, int column, const code_value f[6])
{
  const tree_link *const L = &tree.link[k];
  for (int a = 0; L->moves && a < tree.link[L->parent].n; a++) {
    const int row = tree.link[L->parent].mode_row + a;
    tree_matrix[row][column] = tree_matrix[column][row] =
        tree_write_along(w, tree_nodes[k].twist[a], f, code_variable("H_%d_%d", column, row));
  }
}

/* Elements of the matrix in a column, by momentum f of link k: in the rows of its first n axes, and of all further in. */
static void tree_write_climb(const code *w, int k, int n, int column, code_value f[6], const char *name)
{
  char word[40];
  for (int j = k, from = -1; j >= 0; from = j, j = tree.link[j].parent) {
    const tree_link *const L = &tree.link[j];
    if (from >= 0) {
      code_value up[6];
      tree_nothing(up, 6);
      snprintf(word, sizeof word, "%sf%d", name, from);
      tree_write_to_parent(w, up, &tree.link[from], f, word, k);
      memcpy(f, up, sizeof up);
      node_write_rows(w, from, column, f);
    }
    for (int i = 0; i < L->axes; i++) {
      if (j < k || i < n) {
        const int row = L->row[i];
        tree_matrix[row][column] = tree_matrix[column][row] =
            tree_write_along(w, L->A[i], f, code_variable("H_%d_%d", column, row));
      }
    }
    for (int i = 0; i < 6 && j == tree.root; i++) {
      tree_matrix[i][column] = tree_matrix[column][i] = f[i];
    }
  }
}

/* Right side of the modes of an open body: their momenta p less what hangs on their nodes has at rest. */
static void node_write_right(const code *w, int k, const code_value *p)
{
  const tree_link *const L = &tree.link[k];
  code_sum s;
  for (int a = 0; a < L->n; a++) {
    code_begin(&s);
    code_add_one(&s, 1.0, p[a]);
    for (int c = k + 1; c < tree.n; c++) {
      for (int i = 0; i < 6 && tree.link[c].parent == k && tree.link[c].moves; i++) {
        code_add(&s, -1.0, tree_nodes[c].twist[a][i], tree_nodes[c].rest[i]);
      }
    }
    tree_right[L->mode_row + a] = code_end(w, &s, code_variable("y_%d", L->mode_row + a));
  }
}

/* Elements of the matrix in the columns of the modes of an open body. */
static void node_write_modes(const code *w, int k)
{
  const tree_link *const L = &tree.link[k];
  static double M[FB_MAX_MODES][FB_MAX_MODES];
  code_sum s;
  code_read_sparse(M, &L->model->M, L->n);
  for (int a = 0; a < L->n; a++) {
    code_value f[6], part[6];
    char word[40];
    for (int i = 0; i < 6; i++) {
      f[i] = L->rates.lambda[i][a];
    }
    for (int b = 0; b <= a; b++) {
      tree_matrix[L->mode_row + b][L->mode_row + a] = tree_matrix[L->mode_row + a][L->mode_row + b] =
          large_is(L->model) ? large_mass[k][a][b]
                             : code_constant(L->model->unit_mass ? (a == b ? 1.0 : 0.0) : M[a][b]);
    }
    for (int c = k + 1; c < tree.n; c++) {
      if (tree.link[c].parent == k && tree.link[c].moves) {
        snprintf(word, sizeof word, "nM%d", a);
        tree_write_momentum(w, part, tree_nodes[c].I, tree_nodes[c].twist[a], NULL, word, c);
        for (int b = 0; b <= a; b++) {
          code_value *const H = &tree_matrix[L->mode_row + b][L->mode_row + a];
          code_begin(&s);
          code_add_one(&s, 1.0, *H);
          for (int i = 0; i < 6; i++) {
            code_add(&s, 1.0, tree_nodes[c].twist[b][i], part[i]);
          }
          *H = code_end(w, &s, code_variable("H%d_%d_%d", c, L->mode_row + a, L->mode_row + b));
          tree_matrix[L->mode_row + a][L->mode_row + b] = *H;
        }
        for (int i = 0; i < 6; i++) {
          code_begin(&s);
          code_add_one(&s, 1.0, f[i]);
          code_add_one(&s, 1.0, part[i]);
          f[i] = code_end(w, &s, code_variable("b%d_M%d_%d%s", k, a, c, code_rows[i]));
        }
      }
    }
    snprintf(word, sizeof word, "M%d", a);
    tree_write_climb(w, k, L->axes, L->mode_row + a, f, word);
  }
}

/* Velocity by which the parent and its modes carry link k, as of a body at O of the parent. */
static void node_write_carried(const code *w, code_value V[6], int k)
{
  const tree_link *const L = &tree.link[k], *const P = &tree.link[L->parent];
  memcpy(V, P->V, 6 * sizeof *V);
  for (int i = 0; i < 6 && L->moves; i++) {
    code_sum s;
    code_begin(&s);
    code_add_one(&s, 1.0, V[i]);
    for (int a = 0; a < P->n; a++) {
      code_add(&s, 1.0, tree_nodes[k].twist[a][i], tree_right[P->mode_row + a]);
    }
    V[i] = code_end(w, &s, code_variable("n%d_V%s", k, code_rows[i]));
  }
}

/* Momentum of a body: its own, M_rr V + Lambda q_dot of an open one. */
static void tree_write_own_momentum(const code *w, int k)
{
  tree_link *const L = &tree.link[k];
  code_sum s;
  for (int a = 0; a < L->n && L->open; a++) {
    code_begin(&s);
    code_add_one(&s, 1.0, L->rates.q_dot[a]);
    for (int i = 0; i < 6; i++) {
      code_add(&s, 1.0, L->rates.turned[i][a], L->V[i]);
    }
    L->rates.pb[a] = code_end(w, &s, code_variable("b%d_pb_%d", k, a));
  }
  for (int i = 0; i < 6 && L->open; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, tree_nodes[k].spin[i]);
    rows_add(&s, -1.0, k, i, rows_eff);
    for (int a = 0; a < L->n; a++) {
      code_add(&s, 1.0, L->rates.lambda[i][a], L->rates.q_dot[a]);
    }
    L->own[i] = code_end(w, &s, code_variable("b%d_W_%s", k, code_rows[i]));
  }
  tree_write_momentum(w, L->G, L->open ? tree_nodes[k].M_rr : L->rates.S, L->V, L->own, "G", k);
}

/* ---- forces */

/* Momentum and load of link k to its parent, and kept for the modes that move its node. */
static void node_write_pass_loads(const code *w, int k)
{
  const tree_link *const L = &tree.link[k];
  tree_link *const P = &tree.link[L->parent];
  struct tree_node *const node = &tree_nodes[k];
  const code_value name = code_variable("n%d", k);
  for (int m = 0; m < 2; m++) {
    code_value *const at = m ? node->end.F : node->end.G;
    tree_write_pass(w, m ? P->F : P->G, m ? L->F : L->G, m ? "F" : "G", k);
    for (int i = 0; i < 6 && L->moves; i++) { /* about the node */
      code_sum s;
      code_begin(&s);
      code_add_one(&s, 1.0, node->passed[i]);
      if (i >= 3) {
        tree_add_cross(&s, -1.0, node->end.n, node->passed, i - 3);
      }
      at[i] = code_end(w, &s, code_variable("%s%c%s", name.name, m ? 'F' : 'G', code_rows[i]));
    }
  }
  if (L->moves) {
    rows_write_node_velocity(w, &node->end, name);
  }
}

/* E9.12: what hangs on its nodes, added to the force on each mode of link k. */
static void node_add_modes(const code *w, code_sum *force, int k)
{
  for (int c = k + 1; c < tree.n; c++) {
    if (tree.link[c].parent == k && tree.link[c].moves) {
      rows_add_node(w, force, &tree_nodes[c].end, tree.link[c].joint->parent_node, code_variable("n%d", c));
    }
  }
}
#endif
