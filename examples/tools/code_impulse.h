/* code_impulse.h - rows of loops at a state, the speeds under them and what their impulses do: see code_rows.h, part of
   code_tree.h. */
#ifndef CODE_IMPULSE_H
#define CODE_IMPULSE_H

/* ---- matrices of values */

/* Y = A B of 3 x 3 matrices, A^T where `back` */
static void rows_write_product(const code *w, code_value Y[9], const code_value A[9], int back, const code_value B[9],
                               code_value name)
{
  code_value out[9];
  code_sum s;
  for (int i = 0; i < 9; i++) {
    code_value own;
    code_begin(&s);
    for (int j = 0; j < 3; j++) {
      code_add(&s, 1.0, A[back ? 3 * j + i / 3 : i / 3 * 3 + j], B[3 * j + i % 3]);
    }
    own = code_variable("%s%c%c", name.name, tree_axis[i / 3], tree_axis[i % 3]);
    out[i] = code_end(w, &s, own);
  }
  memcpy(Y, out, sizeof out);
}

/* y = C x, C^T x where `back`, + more */
static void rows_write_turned(const code *w, code_value y[3], const code_value C[9], int back, const code_value x[3],
                              const code_value *more, code_value name)
{
  code_value out[3];
  code_sum s;
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    tree_add_turned(&s, C, back, x, i);
    if (more) {
      code_add_one(&s, 1.0, more[i]);
    }
    out[i] = code_end(w, &s, code_variable("%s%c", name.name, tree_axis[i]));
  }
  memcpy(y, out, sizeof out);
}

static void rows_unit(code_value C[9])
{
  for (int i = 0; i < 9; i++) {
    C[i] = code_constant(i % 4 == 0 ? 1.0 : 0.0);
  }
}

static code_value rows_minus(code_value x)
{
  x.c = -x.c;
  return x;
}

#include "code_spring.h"

/* ---- places */

/* The field of a node (fbi_node_eval) at the vector's q, or its rates at q_dot: what a pair of modes adds. */
static void rows_write_pairs(const code *w, code_value y[FB_MAX_MODES][3], const fb_body *body, const fb_real *linear,
                             const fb_real *chi, const code_value *q, code_value name)
{
  for (int a = 0; a < body->n; a++) {
    for (int i = 0; i < 3; i++) {
      code_sum s;
      code_begin(&s);
      code_add_one(&s, linear ? (double)linear[3 * a + i] : 0.0, code_constant(1.0));
      for (int b = 0; b < body->n && chi; b++) {
        code_add_one(&s, (double)chi[fbi_pair(a, b) + i], q[b]);
      }
      y[a][i] = code_end(w, &s, code_variable("%s%d%c", name.name, a, tree_axis[i]));
    }
  }
}

/* Tables of the second degree of a node; NULL: the body has none. */
static const fb_real *rows_table(const fb_body *body, const fb_node *node, int turns)
{
#if FBI_WITH_QUADRATIC
  if (body->effects & (FB_EFFECT_SPIN_STIFFENING | FB_EFFECT_ACCELERATION_STIFFENING)) {
    return turns ? node->chi_theta : node->chi;
  }
#endif
  (void)body, (void)node, (void)turns;
  return NULL;
}

/* 1/2 (linear + J) q */
static void rows_write_field(const code *w, code_value y[3], const fb_real *linear, code_value J[FB_MAX_MODES][3],
                             const code_value *q, int n, const double *offset, code_value name)
{
  for (int i = 0; i < 3; i++) {
    code_sum s;
    code_begin(&s);
    code_add_one(&s, offset[i], code_constant(1.0));
    for (int a = 0; a < n; a++) {
      code_add_one(&s, 0.5 * (double)linear[3 * a + i], q[a]);
      code_add(&s, 0.5, J[a][i], q[a]);
    }
    y[i] = code_end(w, &s, code_variable("%s%c", name.name, tree_axis[i]));
  }
}

/* J_phi and the turn N of a node by its rotation parameters phi: 1 + scale (phi^ + phi^ phi^/2). */
static void rows_write_node_turn(const code *w, rows_end *end, int n, code_value name)
{
  code_sum s;
  code_value square;
  code_begin(&s);
  for (int i = 0; i < 3; i++) {
    code_add(&s, 0.25, end->phi[i], end->phi[i]);
  }
  code_add_one(&s, 1.0, code_constant(1.0));
  square = code_end(w, &s, code_variable("%ssq", name.name));
  end->scale = code_is_constant(&square) ? code_constant(1.0 / square.c) : code_variable("%ssc", name.name);
  if (!code_is_constant(&square)) {
    fprintf(w->out, "%*sconst %s %s = ", w->indent, "", code_real(w), end->scale.name);
    code_template(w, "`1` / ");
    fprintf(w->out, "%s;\n", square.name);
  }
  for (int a = 0; a < n; a++) {
    for (int i = 0; i < 3; i++) {
      code_value t;
      code_begin(&s);
      code_add_one(&s, 1.0, end->turn[a][i]);
      tree_add_cross(&s, 0.5, end->phi, end->turn[a], i);
      t = code_end(w, &s, code_variable("%st%d%c", name.name, a, tree_axis[i]));
      code_begin(&s);
      code_add(&s, 1.0, end->scale, t);
      end->Jphi[a][i] = code_end(w, &s, code_variable("%sr%d%c", name.name, a, tree_axis[i]));
    }
  }
  for (int e = 0; e < 9; e++) {
    const int i = e / 3, j = e % 3, l = 3 - i - j;
    code_value t;
    code_begin(&s);
    if (i != j) {
      code_add_one(&s, (j - i + 3) % 3 == 1 ? -1.0 : 1.0, end->phi[l]);
      code_add(&s, 0.5, end->phi[i], end->phi[j]);
    } else {
      code_add(&s, -0.5, end->phi[(i + 1) % 3], end->phi[(i + 1) % 3]);
      code_add(&s, -0.5, end->phi[(i + 2) % 3], end->phi[(i + 2) % 3]);
    }
    t = code_end(w, &s, code_variable("%sm%c%c", name.name, tree_axis[i], tree_axis[j]));
    code_begin(&s);
    code_add_one(&s, i == j ? 1.0 : 0.0, code_constant(1.0));
    code_add(&s, 1.0, end->scale, t);
    end->N[e] = code_end(w, &s, code_variable("%sN%c%c", name.name, tree_axis[i], tree_axis[j]));
  }
}

static void rows_read_q(code_value *q, const tree_link *L, int k)
{
  for (int a = 0; a < L->n; a++) {
    q[a] = code_variable("b%d_q_%d", k, a);
  }
}

/* A node of link k: its place and turn, and what its modes do to them. */
static void rows_write_node(const code *w, rows_end *end, int k, int at, code_value name)
{
  const tree_link *const L = &tree.link[k];
  const fb_node *const node = &L->model->node[at];
  const double origin[3] = {(double)node->r[0], (double)node->r[1], (double)node->r[2]}, none[3] = {0, 0, 0};
  end->link = k;
  end->moves = fbi_node_moves(L->model, at);
  if (node->line.line > 0) {
    large_write_node(w, end, k, at, name);
    return;
  }
  for (int i = 0; i < 3; i++) {
    end->n[i] = code_constant(origin[i]);
  }
  if (end->moves) {
    code_value q[FB_MAX_MODES];
    rows_read_q(q, L, k);
    rows_write_pairs(w, end->Ju, L->model, node->psi, rows_table(L->model, node, 0), q,
                     code_variable("%sJ", name.name));
    rows_write_pairs(w, end->turn, L->model, node->theta, rows_table(L->model, node, 1), q,
                     code_variable("%sT", name.name));
    rows_write_field(w, end->n, node->psi, end->Ju, q, L->n, origin, code_variable("%sn", name.name));
    rows_write_field(w, end->phi, node->theta, end->turn, q, L->n, none, code_variable("%sp", name.name));
    rows_write_node_turn(w, end, L->n, name);
  }
}

/* The node of side s of loop j. */
static void rows_write_end(const code *w, int j, int s)
{
  rows_end *const end = &constraint.loop[j].end[s];
  const fb_joint *const joint = constraint.loop[j].joint;
  const int at = s == 1 ? joint->child_node : joint->moves ? joint->parent_node : 0;
  rows_unit(end->N);
  tree_nothing(end->n, 3);
  end->moves = 0;
  if (end->link >= 0) {
    rows_write_node(w, end, end->link, at, code_variable("l%d_%d", j, s));
  }
}

/* Is `of` link k, or does k hang on it? -1: the ground. */
static int rows_hangs(int k, int of)
{
  while (k >= 0 && k != of) {
    k = tree.link[k].parent;
  }
  return k == of;
}

/* Axes R and place rho of link k as another one sees it that it hangs on. */
static void rows_write_chain(const code *w, code_value R[9], code_value rho[3], int k, int on, code_value name)
{
  const int place = tree.tracked ? TREE_PUSHED : TREE_PUSHED - 3;
  rows_unit(R);
  tree_nothing(rho, 3);
  for (; k != on; k = tree.link[k].parent) {
    const tree_link *const L = &tree.link[k];
    code_value C[9], s[3];
    for (int i = 0; i < 9; i++) {
      C[i] = k == tree.root ? code_variable("R[%d]", i) : L->C[i];
      s[i % 3] = k == tree.root ? code_variable("x[%d]", L->p + place + i % 3) : L->s[i % 3];
    }
    rows_write_turned(w, rho, C, 0, rho, s, code_variable("%s%dp", name.name, k));
    rows_write_product(w, R, C, 0, R, code_variable("%s%d", name.name, k));
  }
}

/* Joint axes of the child, P axes; what a screw misses by them, and those of a spherical joint that is locked. */
static void rows_write_child_axes(const code *w, int j)
{
  rows_loop *const l = &constraint.loop[j];
  for (int c = 0; c < 3; c++) {
    code_value b[3];
    for (int i = 0; i < 3; i++) {
      b[i] = code_constant((double)l->joint->child_axes[3 * i + c]);
    }
    rows_write_turned(w, b, l->end[1].N, 0, b, NULL, code_variable("l%d_c%c", j, tree_axis[c]));
    rows_write_turned(w, l->b[c], l->end[1].D, 1, b, NULL, code_variable("l%d_b%c", j, tree_axis[c]));
  }
  if (fbi_traits(l->joint)->pitched) {
    l->miss = rows_write_screw(w, j);
  }
  if (rows_held(l->joint) == 4) {
    rows_write_lock(w, j);
  }
}

/* Frames of loop j (fbi_frames_eval), in P axes. */
static void rows_write_frames(const code *w, int j)
{
  rows_loop *const l = &constraint.loop[j];
  rows_end *const on = &l->end[0], *const of = &l->end[1];
  code_value R[2][9], rho[2][3], axes[9], far[3], x[3], local[3];
  code_sum s;
  l->common = on->link;
  while (!rows_hangs(of->link, l->common)) {
    l->common = tree.link[l->common].parent;
  }
  rows_write_end(w, j, 0);
  rows_write_end(w, j, 1);
  rows_write_chain(w, R[0], rho[0], on->link, l->common, code_variable("l%d_a", j));
  rows_write_chain(w, R[1], rho[1], of->link, l->common, code_variable("l%d_b", j));

  /* D: P axes to those of the bodies */
  tree_constants(axes, l->joint->axes, 9);
  rows_write_product(w, on->D, on->N, 0, axes, code_variable("l%d_0D", j));
  rows_write_product(w, R[0], R[0], 0, on->D, code_variable("l%d_0R", j)); /* P to the common axes */
  rows_write_product(w, of->D, R[1], 1, R[0], code_variable("l%d_1D", j));

  /* from the parent's origin to the child's, arms */
  for (int i = 0; i < 3; i++) {
    local[i] = code_constant((double)l->joint->child_position[i]);
  }
  rows_write_turned(w, x, of->N, 0, local, NULL, code_variable("l%d_1o", j));
  rows_write_turned(w, of->arm, of->D, 1, x, NULL, code_variable("l%d_1A", j));
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, x[i]);
    code_add_one(&s, 1.0, of->n[i]);
    far[i] = code_end(w, &s, code_variable("l%d_1x%c", j, tree_axis[i]));
  }
  rows_write_turned(w, far, R[1], 0, far, rho[1], code_variable("l%d_1y", j));
  rows_write_turned(w, x, R[0], 1, rho[0], NULL, code_variable("l%d_0z", j));
  rows_write_turned(w, far, R[0], 1, far, NULL, code_variable("l%d_1z", j));
  rows_write_turned(w, local, on->D, 1, on->n, NULL, code_variable("l%d_0d", j));
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, far[i]);
    code_add_one(&s, -1.0, x[i]);
    code_add_one(&s, -1.0, local[i]);
    on->arm[i] = code_end(w, &s, code_variable("l%d_0A%c", j, tree_axis[i]));
  }
  for (int i = 0; i < 3; i++) {
    local[i] = code_constant((double)l->joint->position[i]);
  }
  rows_write_turned(w, local, on->N, 0, local, NULL, code_variable("l%d_0o", j));
  rows_write_turned(w, local, on->D, 1, local, NULL, code_variable("l%d_0P", j));
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, on->arm[i]);
    code_add_one(&s, -1.0, local[i]);
    l->step[i] = code_end(w, &s, code_variable("l%d_step%c", j, tree_axis[i]));
  }
  rows_write_child_axes(w, j);
}

/* ---- the rows */

/* b x a of axis i */
static void rows_across(code_value torque[3], const code_value b[3], int i)
{
  const int y = (i + 1) % 3, z = (i + 2) % 3;
  torque[y] = b[z];
  torque[z] = rows_minus(b[y]);
}

/* Force and torque of a row at the joint's origin on the child, P axes: a translation, a right angle, a screw, an axis
   that turns (E9.8). */
static void rows_direction(code_value force[3], code_value torque[3], const rows_loop *l, const rows_row *row)
{
  const int hold = row->hold;
  tree_nothing(force, 3);
  tree_nothing(torque, 3);
  if (hold == ROWS_SCREW) {
    force[2] = code_constant(1.0);
    torque[2] = code_constant(-(double)l->joint->pitch);
  } else if (hold < 3) {
    force[hold] = code_constant(1.0);
  } else if (hold < ROWS_SCREW) {
    rows_across(torque, l->b[(hold - 3) % 3], (hold - 3) / 3);
  } else if (l->joint->kind == FB_JOINT_SPHERICAL && l->joint->mode[row->axis] == FB_AXIS_LOCKED) {
    rows_across(torque, l->lock[row->axis], row->axis);
  } else {
    rows_axis(force, torque, l, row->axis);
  }
}

/* Its wrench on side s of the loop, and on the modes there. */
static void rows_write_side(const code *w, int r, int s)
{
  rows_row *const row = &constraint.row[r];
  const rows_loop *const l = &constraint.loop[row->loop];
  const rows_end *const end = &l->end[s];
  const code_value name = code_variable("g%d_%d", r, s);
  code_value force[3], torque[3], f[3], t[3];
  code_sum sum;
  rows_direction(force, torque, l, row);
  for (int i = 0; i < 3; i++) {
    code_begin(&sum);
    code_add_one(&sum, 1.0, torque[i]);
    tree_add_cross(&sum, 1.0, end->arm, force, i);
    row->torque[s][i] = code_end(w, &sum, code_variable("%sT%c", name.name, tree_axis[i]));
    row->force[s][i] = s == 0 ? rows_minus(force[i]) : force[i];
    row->torque[s][i] = s == 0 ? rows_minus(row->torque[s][i]) : row->torque[s][i];
  }
  tree_nothing(row->pure[s], 6);
  tree_nothing(row->eff[s], 6);
  tree_nothing(row->e[s], FB_MAX_MODES);
  tree_nothing(row->bent[s], FB_MAX_MODES);
  if (end->link < 0) {
    return;
  }
  rows_write_turned(w, f, end->D, 0, row->force[s], NULL, code_variable("%sf", name.name));
  rows_write_turned(w, t, end->D, 0, row->torque[s], NULL, code_variable("%st", name.name));
  for (int i = 0; i < 3; i++) {
    row->pure[s][i] = f[i];
    code_begin(&sum);
    code_add_one(&sum, 1.0, t[i]);
    tree_add_cross(&sum, 1.0, end->n, f, i);
    row->pure[s][3 + i] = code_end(w, &sum, code_variable("%sm%c", name.name, tree_axis[i]));
  }
  for (int a = 0; a < tree.link[end->link].n && end->moves; a++) {
    code_begin(&sum);
    for (int i = 0; i < 3; i++) {
      code_add(&sum, 1.0, end->Ju[a][i], f[i]);
      code_add(&sum, 1.0, end->Jphi[a][i], t[i]);
    }
    row->e[s][a] = code_end(w, &sum, code_variable("%se%d", name.name, a));
  }
}

/* What the modes of a side take of it, -Lambda M^-1 e, in `taken`; the wrench less that. */
static void rows_write_taken(const code *w, code_value taken[6], int r, int s)
{
  rows_row *const row = &constraint.row[r];
  const rows_end *const end = &constraint.loop[row->loop].end[s];
  const code_value name = code_variable("g%d_%d", r, s);
  code_sum sum;
  tree_nothing(taken, 6);
  memcpy(row->eff[s], row->pure[s], sizeof row->eff[s]);
  if (end->link >= 0 && end->moves && !tree.link[end->link].open) {
    const tree_link *const L = &tree.link[end->link];
    if (constraint.by) {
      constraint.by(w, end->link, row->bent[s], row->e[s], code_variable("%sw", name.name).name);
    } else {
      const code own = tree_enter(w, end->link);
      code_of_names = "";
      code_write_solve(&own, row->bent[s], row->e[s], code_variable("%sw", name.name).name);
      tree_leave(end->link);
    }
    for (int i = 0; i < 6; i++) {
      code_begin(&sum);
      for (int a = 0; a < L->n; a++) {
        code_add(&sum, -1.0, L->rates.lambda[i][a], row->bent[s][a]);
      }
      taken[i] = code_end(w, &sum, code_variable("%sk%s", name.name, code_rows[i]));
      code_begin(&sum);
      code_add_one(&sum, 1.0, row->pure[s][i]);
      code_add_one(&sum, 1.0, taken[i]);
      row->eff[s][i] = code_end(w, &sum, code_variable("%sv%s", name.name, code_rows[i]));
    }
  }
}

/* A wrench f on the free root, whose twists are the six units, added to the coefficients of row r; its size to bound[]. */
static void rows_write_root(const code *w, int r, const code_value f[6], code_sum *bound, char word)
{
  code_value *const c = constraint.row[r].coefficient;
  for (int a = 0; a < 6; a++) {
    code_sum s;
    code_begin(&s);
    code_add_one(&s, 1.0, c[a]);
    code_add_one(&s, 1.0, f[a]);
    c[a] = code_end(w, &s, code_variable("g%d_%c%d_%d", r, word, tree.root, a));
    for (int i = 0; i < 6; i++) {
      code_add(&bound[a], 1.0, f[i], f[i]);
    }
  }
}

/* The wrench f of a row on modes that move the node of link k, about O of its parent, added to the row. */
static void rows_write_passed(const code *w, int r, int k, const code_value f[6], code_sum *bound, char word)
{
  const int first = tree.link[tree.link[k].parent].mode_row;
  for (int a = 0; a < tree.link[tree.link[k].parent].n; a++) {
    code_value *const c = &constraint.row[r].coefficient[first + a];
    code_sum s;
    code_begin(&s);
    code_add_one(&s, 1.0, *c);
    for (int i = 0; i < 6; i++) {
      code_add(&s, 1.0, tree_nodes[k].twist[a][i], f[i]);
      code_add(&bound[first + a], 1.0, f[i], f[i]);
    }
    *c = code_end(w, &s, code_variable("g%d_%cn%d_%d", r, word, k, a));
  }
}

/* From link k to `on`: a wrench y on the axes and on modes that move joints, added to the coefficients of row r; its
   size on them to bound[]. */
static void rows_write_along(const code *w, int r, int k, int on, const code_value y[6], code_sum *bound, char word)
{
  rows_row *const row = &constraint.row[r];
  code_value f[6], up[6];
  char name[16];
  code_sum s;
  memcpy(f, y, sizeof f);
  for (; k != on; k = tree.link[k].parent) {
    const tree_link *const L = &tree.link[k];
    for (int a = 0; a < L->axes; a++) {
      code_value *const c = &row->coefficient[L->row[a]];
      code_begin(&s);
      code_add_one(&s, 1.0, *c);
      for (int i = 0; i < 6; i++) {
        code_add(&s, 1.0, L->A[a][i], f[i]);
        code_add(&bound[L->row[a]], 1.0, f[i], f[i]);
      }
      *c = code_end(w, &s, code_variable("g%d_%c%d_%d", r, word, k, a));
    }
    if (k == tree.root) {
      rows_write_root(w, r, f, bound, word);
    }
    if (L->parent >= 0 && (L->parent != on || L->moves)) {
      tree_nothing(up, 6);
      snprintf(name, sizeof name, "g%d%c", r, word);
      tree_write_to_parent(w, up, L, f, name, k);
      memcpy(f, up, sizeof f);
    }
    if (L->moves) {
      rows_write_passed(w, r, k, f, bound, word);
    }
  }
}

static code_value rows_square(const code *w, const code_value *x, int n, code_value name)
{
  code_sum s;
  code_begin(&s);
  for (int i = 0; i < n; i++) {
    code_add(&s, 1.0, x[i], x[i]);
  }
  return code_end(w, &s, name);
}

/* What side s of row r does to the modes of an open body, added to its coefficients. */
static void rows_write_open(const code *w, int r, int s, code_sum *bound)
{
  rows_row *const row = &constraint.row[r];
  const int k = constraint.loop[row->loop].end[s].link;
  for (int a = 0; k >= 0 && tree.link[k].open && a < tree.link[k].n; a++) {
    code_value *const c = &row->coefficient[tree.link[k].mode_row + a];
    code_sum sum;
    code_begin(&sum);
    code_add_one(&sum, 1.0, *c);
    code_add_one(&sum, 1.0, row->e[s][a]);
    code_add(&bound[tree.link[k].mode_row + a], 1.0, row->e[s][a], row->e[s][a]);
    *c = code_end(w, &sum, code_variable("g%d_o%d_%d", r, s, a));
  }
}

/* Wrenches of row r and what they do to the axes. Does it move anything? */
static int rows_write_row(const code *w, int r, code_sum *bound)
{
  rows_row *const row = &constraint.row[r];
  const rows_loop *const l = &constraint.loop[row->loop];
  int acts = 0;
  tree_nothing(row->coefficient, CODE_ROWS);
  for (int i = 0; i < CODE_ROWS; i++) {
    code_begin(&bound[i]);
  }
  for (int s = 0; s < 2; s++) {
    rows_write_side(w, r, s);
    rows_write_along(w, r, l->end[s].link, l->common, row->pure[s], bound, s ? 'P' : 'p');
    rows_write_open(w, r, s, bound);
  }
  memcpy(row->direct, row->coefficient, sizeof row->direct);
  for (int s = 0; s < 2; s++) {
    code_value taken[6];
    rows_write_taken(w, taken, r, s);
    rows_write_along(w, r, l->end[s].moves ? l->end[s].link : -1, -1, taken, bound, s ? 'K' : 'k');
    for (int a = 0; a < FB_MAX_MODES; a++) {
      acts |= !code_is_zero(&row->e[s][a]);
    }
  }
  for (int i = 0; i < CODE_ROWS; i++) {
    acts |= !code_is_zero(&row->coefficient[i]);
  }
  acts |= row->axis >= 0 && l->joint->mode[row->axis] == FB_AXIS_PRESCRIBED; /* or what moves nothing has a speed */
  row->value = row->axis >= 0            ? rows_write_given(w, row)
               : row->hold == ROWS_SCREW ? l->miss
               : row->hold < 3           ? l->step[row->hold]
                                         : l->b[(row->hold - 3) % 3][(row->hold - 3) / 3];
  return acts;
}

/* Bound of Q_rr, as if wrenches were parallel to the twists: sum of A.A W.W/pivot, and of the modes'. */
static void rows_write_bound(const code *w, int r, code_sum *bound, const code_factor *f, const int *order)
{
  const rows_row *const row = &constraint.row[r];
  static code_sum s;
  char target[32];
  code_begin(&s);
  for (int k = 0; k < f->n; k++) {
    const int mode = order[k] >= (tree.root >= 0 ? 6 : 0) + tree.n_axis; /* as if twists were of 1 */
    if ((tree.root >= 0 && order[k] < 6) || mode) {
      const code_value size = code_end(w, &bound[order[k]], code_variable("g%d_B%d", r, order[k]));
      code_add(&s, 1.0, size, f->share[k]);
    }
    for (int j = 0; j < tree.n; j++) {
      const tree_link *const L = &tree.link[j];
      int a = 0;
      while (a < L->axes && L->row[a] != order[k]) {
        a++;
      }
      if (!mode && a < L->axes && bound[order[k]].n + (fabs(bound[order[k]].constant) > 0) > 0) {
        code_value size = code_end(w, &bound[order[k]], code_variable("g%d_B%d", r, order[k]));
        const code_value twist = rows_square(w, L->A[a], 6, code_variable("g%d_A%d", r, order[k]));
        code_sum product;
        code_begin(&product);
        code_add(&product, 1.0, size, twist);
        size = code_end(w, &product, code_variable("g%d_C%d", r, order[k]));
        code_add(&s, 1.0, size, f->share[k]);
      }
    }
  }
  for (int side = 0; side < 2; side++) {
    for (int a = 0; a < FB_MAX_MODES; a++) {
      code_add(&s, 1.0, row->e[side][a], row->bent[side][a]);
    }
  }
  snprintf(target, sizeof target, "above[%d]", row->acts);
  code_assign(w, &s, target);
}

/* Y = L^-1 A^T of row r */
static void rows_write_share(const code *w, int r, const code_factor *f, const int *order)
{
  rows_row *const row = &constraint.row[r];
  for (int k = 0; k < f->n; k++) {
    code_sum s;
    code_begin(&s);
    code_add_one(&s, 1.0, row->coefficient[order[k]]);
    for (int m = 0; m < k; m++) {
      code_add(&s, -1.0, f->low[k][m], row->Y[m]);
    }
    row->Y[k] = code_end(w, &s, code_variable("g%d_Y%d", r, k));
  }
}

/* Elements of Q up to the diagonal of row r. */
static void rows_write_matrix(const code *w, int r, const code_factor *f)
{
  static code_sum s;
  rows_row *const row = &constraint.row[r];
  for (int k = 0; k < f->n; k++) {
    code_begin(&s);
    code_add(&s, 1.0, row->Y[k], f->share[k]);
    row->by[k] = code_end(w, &s, code_variable("g%d_D%d", r, k));
  }
  for (int i = 0; i <= r; i++) {
    const rows_row *const other = &constraint.row[i];
    char target[32];
    if (other->acts < 0) {
      continue;
    }
    code_begin(&s);
    for (int k = 0; k < f->n; k++) {
      code_add(&s, 1.0, row->by[k], other->Y[k]);
    }
    for (int side = 0; side < 4; side++) {
      const int a = side / 2, b = side % 2;
      const int same = constraint.loop[row->loop].end[a].link == constraint.loop[other->loop].end[b].link;
      for (int m = 0; m < FB_MAX_MODES && same; m++) {
        code_add(&s, 1.0, row->bent[a][m], other->e[b][m]);
      }
    }
    snprintf(target, sizeof target, "Q[%d]", row->acts * constraint.acting + other->acts);
    code_assign(w, &s, target);
  }
}

/* Are there loops, and prescribed speeds? */
static int rows_are_driven(void)
{
  return constraint.n > 0 && tree.n_driven + constraint.n_driven > 0;
}

/* Sum of the squares of the terms of a row's c, of whose size it has round-off. */
static void rows_write_rough(const code *w, int r, const code_sum *c)
{
  static code_sum one, square;
  const int acts = constraint.row[r].acts;
  char target[32];
  code_begin(&square);
  for (int i = 0; i < c->n; i++) {
    code_value x = {c->term[i].c, ""}, y = {1.0, ""}, term;
    strcpy(x.name, c->term[i].x);
    strcpy(y.name, c->term[i].y);
    code_begin(&one);
    code_add(&one, 1.0, x, y);
    term = code_end(w, &one, code_variable("g%d_t%d", r, i));
    code_add(&square, 1.0, term, term);
  }
  snprintf(target, sizeof target, "rough[%d]", acts);
  code_assign(w, &square, target);
}

/* c + A u without impulses; closes: its value is added where positions are closed. */
static void rows_write_rest(const code *w, int r, const code_factor *f, const code_value *z, int closes)
{
  static code_sum s;
  const rows_row *const row = &constraint.row[r];
  char target[32];
  code_begin(&s);
  for (int k = 0; k < f->n; k++) {
    code_add(&s, 1.0, row->by[k], z[k]);
  }
  for (int i = f->n; i < f->n + tree.n_given; i++) {
    code_add(&s, 1.0, row->coefficient[i], tree_right[i]);
  }
  for (int side = 0; side < 2; side++) {
    const int link = constraint.loop[row->loop].end[side].link;
    for (int a = 0; link >= 0 && a < tree.link[link].n; a++) {
      code_add(&s, 1.0, row->bent[side][a], tree.link[link].rates.pi[a]);
    }
  }
  if (closes) {
    code_add(&s, 1.0, code_variable("closes"), row->value);
  }
  if (row->axis >= 0 && !constraint.by && constraint.loop[row->loop].joint->mode[row->axis] == FB_AXIS_PRESCRIBED) {
    code_add_one(&s, -1.0, code_variable("l%d_r_%d", row->loop, row->axis));
  }
  snprintf(target, sizeof target, "c[%d]", row->acts);
  code_assign(w, &s, target);
  if (rows_are_driven()) {
    rows_write_rough(w, r, &s);
  }
}

/* Multiplier of row r as a value */
static code_value rows_mu(int r)
{
  return constraint.row[r].acts < 0 ? code_constant(0.0) : code_plain("mu[%d]", constraint.row[r].acts);
}

/* The speeds under the constraints, in place of code_write_substitution. */
static void rows_write_solve(const code *w, code_factor *f, const int *order, char names[CODE_ROWS][CODE_NAME],
                             int closes)
{
  static code_sum bound[CODE_ROWS];
  code_value z[CODE_ROWS];
  code_sum s;
  fputs("\n  /* E9.8: rows of the loops; E9.9: Q = A M^-1 A^T */\n", w->out);
  constraint.acting = 0;
  for (int r = 0; r < constraint.n; r++) {
    const int acts = rows_write_row(w, r, bound);
    constraint.row[r].acts = acts ? constraint.acting++ : -1;
    if (acts) {
      rows_write_bound(w, r, bound, f, order);
      rows_write_share(w, r, f, order);
    }
  }
  code_write_forward(w, f, z);
  for (int r = 0; r < constraint.n; r++) {
    if (constraint.row[r].acts >= 0) {
      rows_write_matrix(w, r, f);
      rows_write_rest(w, r, f, z, closes);
    }
  }
  code_template(w, "\n  /* E9.10: M u = p + A^T mu */\n  @_rows_solve(mu, Q, c, above);\n");
  code_template(w, rows_are_driven() ? "  (void)rough; /* of motion, which checks nothing */\n" : "");
  for (int k = 0; k < f->n; k++) {
    code_begin(&s);
    code_add_one(&s, 1.0, z[k]);
    for (int r = 0; r < constraint.n; r++) {
      code_add(&s, 1.0, rows_mu(r), constraint.row[r].Y[k]);
    }
    z[k] = code_end(w, &s, code_variable("zc_%d", k));
  }
  code_write_backward(w, f, z, names);
}

static const char rows_functions[] =
    "\n/* E9.9: Q mu = -c on the rows that are independent, zero on the others; Q: its lower triangle, which is "
    "spoiled.\n"
    "   bound: of its diagonal, below 1e-20 of which a row moves nothing but by round-off; where speeds are "
    "prescribed\n"
    "   it becomes the angle to the others of a row that is left out. */\n"
    "static void @_rows_solve($ *mu, $ *Q, const $ *c, $ *bound)\n{\n"
    "  $ L[@_ROWS * @_ROWS], left[@_ROWS], scale[@_ROWS], y[@_ROWS];\n"
    "  int order[@_ROWS], rank;\n"
    "  for (int i = 0; i < @_ROWS; i++) {\n"
    "    $ most = `0`;\n"
    "    for (int r = 0; r < @_ROWS; r++) {\n"
    "      const $ d = Q[r * (@_ROWS + 1)];\n"
    "      most = @_kind[r] == @_kind[i] && d > most ? d : most;\n"
    "      Q[i * @_ROWS + r] = r > i ? Q[r * @_ROWS + i] : Q[i * @_ROWS + r];\n    }\n"
    "    left[i] = Q[i * (@_ROWS + 1)];\n"
    "    if (left[i] > @_along * bound[i]) {\n"
    "      most = left[i] > @_heavy * most ? left[i] : @_heavy * most;\n    }\n"
    "    scale[i] = left[i] > @_across * bound[i] ? most : @_huge;\n"
    "    order[i] = i;\n"
    "    mu[i] = `0`;\n  }\n"
    "  for (rank = 0; rank < @_ROWS; rank++) {\n"
    "    int best = rank, p;\n"
    "    $ by;\n"
    "    for (int i = rank + 1; i < @_ROWS; i++) {\n"
    "      const int a = order[i], b = order[best];\n"
    "      best += (left[a] * scale[b] > @_equal * left[b] * scale[a]) * (i - best);\n    }\n"
    "    p = order[best];\n"
    "    if (!(left[p] > @_apart * scale[p])) {\n      break;\n    }\n"
    "    order[best] = order[rank];\n"
    "    order[rank] = p;\n"
    "    by = left[p] = `1` / sqrt~(left[p]);\n"
    "    for (int i = rank + 1; i < @_ROWS; i++) {\n"
    "      const int r = order[i];\n"
    "      $ sum = Q[r * @_ROWS + p];\n"
    "      for (int j = 0; j < rank; j++) {\n        sum -= L[r * @_ROWS + j] * L[p * @_ROWS + j];\n      }\n"
    "      L[r * @_ROWS + rank] = sum * by;\n"
    "      left[r] -= sum * by * (sum * by);\n    }\n  }\n"
    "  for (int k = 0; k < rank; k++) {\n"
    "    y[k] = -c[order[k]];\n"
    "    for (int j = 0; j < k; j++) {\n      y[k] -= L[order[k] * @_ROWS + j] * y[j];\n    }\n"
    "    y[k] *= left[order[k]];\n  }\n"
    "  for (int k = rank - 1; k >= 0; k--) {\n"
    "    for (int i = k + 1; i < rank; i++) {\n      y[k] -= L[order[i] * @_ROWS + k] * mu[order[i]];\n    }\n"
    "    mu[order[k]] = y[k] * left[order[k]];\n  }\n";

static const char rows_angles[] = "  for (int k = rank; k < @_ROWS; k++) {\n"
                                  "    const int r = order[k];\n"
                                  "    const $ far = left[r] / scale[r];\n"
                                  "    bound[r] = far > `0` ? sqrt~(far) : `0`;\n  }\n";

/* ---- what the impulses do */

/* x += mu times what row r has of it, on all rows that act on link k, by `of` its n numbers on a side. */
typedef const code_value *rows_part(const rows_row *row, int s);

static const code_value *rows_eff(const rows_row *row, int s)
{
  return row->eff[s];
}

static const code_value *rows_bent(const rows_row *row, int s)
{
  return row->bent[s];
}

static const code_value *rows_pushed(const rows_row *row, int s)
{
  return row->e[s];
}

static void rows_add(code_sum *sum, double sign, int k, int i, rows_part *of)
{
  for (int r = 0; r < constraint.n; r++) {
    for (int s = 0; s < 2; s++) {
      if (constraint.loop[constraint.row[r].loop].end[s].link == k) {
        code_add(sum, sign, rows_mu(r), of(&constraint.row[r], s)[i]);
      }
    }
  }
}

static int rows_push(int k)
{
  int pushed = 0;
  for (int j = 0; j < 2 * constraint.n_loop; j++) {
    pushed |= constraint.loop[j / 2].end[j % 2].link == k;
  }
  return pushed;
}

/* Momentum at rest of link k less its share of the impulses, M^-1 pi with it; then G is that of p = A.G (E9.14). */
static void rows_write_momenta(const code *w, int k)
{
  tree_link *const L = &tree.link[k];
  code_sum s;
  for (int i = 0; i < 6 && rows_push(k) && !L->open; i++) { /* else tree_write_own_momentum */
    code_begin(&s);
    code_add_one(&s, 1.0, L->own[i]);
    rows_add(&s, -1.0, k, i, rows_eff);
    L->own[i] = code_end(w, &s, code_variable("b%d_oc_%s", k, code_rows[i]));
  }
  for (int a = 0; a < L->n && rows_push(k); a++) {
    code_begin(&s);
    code_add_one(&s, 1.0, L->rates.pb[a]);
    rows_add(&s, 1.0, k, a, rows_bent);
    L->rates.pb[a] = code_end(w, &s, code_variable("b%d_bc_%d", k, a));
  }
}

/* q_dot with the impulses */
static void rows_write_q_dot(const code *w, int k)
{
  tree_link *const L = &tree.link[k];
  code_sum s;
  for (int a = 0; a < L->n && rows_push(k); a++) {
    code_begin(&s);
    code_add_one(&s, 1.0, L->rates.q_dot[a]);
    rows_add(&s, 1.0, k, a, rows_bent);
    L->rates.q_dot[a] = code_end(w, &s, code_variable("b%d_qc_%d", k, a));
  }
}

/* Velocity of a node, body axes. */
static void rows_write_node_velocity(const code *w, rows_end *end, code_value name)
{
  const tree_link *const L = &tree.link[end->link];
  code_sum s;
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, L->V[i]);
    tree_add_cross(&s, 1.0, L->V + 3, end->n, i);
    for (int a = 0; a < L->n && end->moves; a++) {
      code_add(&s, 1.0, end->Ju[a][i], L->rates.q_dot[a]);
    }
    end->at[i] = code_end(w, &s, code_variable("%sv%c", name.name, tree_axis[i]));
  }
}

/* Velocity of an end. */
static void rows_write_velocity(const code *w, int j, int side)
{
  rows_end *const end = &constraint.loop[j].end[side];
  const code_value name = code_variable("l%d_%d", j, side);
  const tree_link *const L = end->link >= 0 ? &tree.link[end->link] : NULL;
  code_value spin[3];
  code_sum s;
  tree_nothing(end->pushed, FB_MAX_MODES);
  tree_nothing(end->at, 3);
  tree_nothing(end->v, 3);
  tree_nothing(end->spin, 3);
  if (!L) {
    return;
  }
  rows_write_node_velocity(w, end, name);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, L->V[3 + i]);
    for (int a = 0; a < L->n && end->moves; a++) {
      code_add(&s, 1.0, end->Jphi[a][i], L->rates.q_dot[a]);
    }
    spin[i] = code_end(w, &s, code_variable("%sw%c", name.name, tree_axis[i]));
  }
  rows_write_turned(w, end->v, end->D, 1, end->at, NULL, code_variable("%sV", name.name));
  rows_write_turned(w, end->spin, end->D, 1, spin, NULL, code_variable("%sW", name.name));
}

/* y = a x b */
static void rows_write_cross(const code *w, code_value y[3], const code_value a[3], const code_value b[3],
                             const code_value *more, code_value name)
{
  code_sum s;
  code_value out[3];
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    tree_add_cross(&s, 1.0, a, b, i);
    if (more) {
      code_add_one(&s, 1.0, more[i]);
    }
    out[i] = code_end(w, &s, code_variable("%s%c", name.name, tree_axis[i]));
  }
  memcpy(y, out, sizeof out);
}

/* Force f and torque T of a loop at the child's joint origin and their rates, P axes. */
static void rows_write_impulse(const code *w, int j, code_value f[3], code_value T[3], code_value f_dot[3],
                               code_value T_dot[3])
{
  const rows_loop *const l = &constraint.loop[j];
  code_value a_dot[3][3], b_dot[3][3];
  code_sum s, rate[3];
  tree_nothing(f, 3);
  for (int r = l->first; r < l->first + l->n; r++) {
    const int hold = constraint.row[r].hold;
    if (rows_pushes(hold)) {
      f[hold == ROWS_SCREW ? 2 : hold] = rows_mu(r);
    }
  }
  rows_write_cross(w, f_dot, l->end[0].spin, f, NULL, code_variable("l%d_fd", j));
  for (int c = 0; c < 3; c++) {
    code_value unit[3];
    tree_nothing(unit, 3);
    unit[c] = code_constant(1.0);
    rows_write_cross(w, a_dot[c], l->end[0].spin, unit, NULL, code_variable("l%d_ad%c", j, tree_axis[c]));
    rows_write_cross(w, b_dot[c], l->end[1].spin, l->b[c], NULL, code_variable("l%d_bd%c", j, tree_axis[c]));
  }
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_begin(&rate[i]);
    for (int r = l->first; r < l->first + l->n; r++) {
      const int hold = constraint.row[r].hold;
      if (hold == ROWS_SCREW) { /* -pitch mu along z, and how that turns */
        code_value along[3];
        tree_nothing(along, 3);
        along[2] = rows_mu(r);
        along[2].c *= -(double)l->joint->pitch;
        code_add_one(&s, 1.0, along[i]);
        tree_add_cross(&rate[i], 1.0, l->end[0].spin, along, i);
      } else if (hold == ROWS_TURN) { /* which turns with the parent */
        code_value unused[3], axis[3], turns;
        code_sum one;
        rows_direction(unused, axis, l, &constraint.row[r]);
        code_add(&s, 1.0, rows_mu(r), axis[i]);
        code_begin(&one);
        tree_add_cross(&one, 1.0, l->end[0].spin, axis, i);
        turns = code_end(w, &one, code_variable("l%d_tg%d%c", j, r, tree_axis[i]));
        code_add(&rate[i], 1.0, rows_mu(r), turns);
      } else if (hold >= 3) {
        const int of = (hold - 3) / 3;
        const code_value *const b = l->b[(hold - 3) % 3], *const b_rate = b_dot[(hold - 3) % 3];
        code_value unit[3], d;
        code_sum one;
        tree_nothing(unit, 3);
        unit[of] = code_constant(1.0);
        code_begin(&one);
        tree_add_cross(&one, 1.0, b, unit, i);
        code_add(&s, 1.0, rows_mu(r), code_end(w, &one, code_variable("l%d_t%d%c", j, r, tree_axis[i])));
        code_begin(&one);
        tree_add_cross(&one, 1.0, b_rate, unit, i);
        tree_add_cross(&one, 1.0, b, a_dot[of], i);
        d = code_end(w, &one, code_variable("l%d_td%d%c", j, r, tree_axis[i]));
        code_add(&rate[i], 1.0, rows_mu(r), d);
      }
    }
    T[i] = code_end(w, &s, code_variable("l%d_T%c", j, tree_axis[i]));
    T_dot[i] = code_end(w, &rate[i], code_variable("l%d_Td%c", j, tree_axis[i]));
  }
}

/* E9.13 of loop j: momentum and load at both nodes, and on the bodies. */
static void rows_write_load(const code *w, int j)
{
  rows_loop *const l = &constraint.loop[j];
  code_value f[3], T[3], f_dot[3], T_dot[3], far[3];
  code_sum s;
  rows_write_impulse(w, j, f, T, f_dot, T_dot);
  rows_write_cross(w, far, l->end[1].spin, l->end[1].arm, l->end[1].v, code_variable("l%d_far", j));
  rows_write_springs(w, j, far);
  for (int side = 0; side < 2; side++) {
    rows_end *const end = &l->end[side];
    const code_value name = code_variable("l%d_%d", j, side);
    const double sign = side == 0 ? 1.0 : -1.0; /* minus that of the impulse on it */
    code_value arm_dot[3], t[3], t_dot[3];
    if (end->link < 0) {
      continue;
    }
    for (int i = 0; i < 3; i++) {
      code_begin(&s);
      code_add_one(&s, 1.0, far[i]);
      code_add_one(&s, -1.0, end->v[i]);
      arm_dot[i] = code_end(w, &s, code_variable("%sad%c", name.name, tree_axis[i]));
    }
    rows_write_cross(w, t, end->arm, f, T, code_variable("%stq", name.name));
    rows_write_cross(w, t_dot, arm_dot, f, T_dot, code_variable("%stx", name.name));
    rows_write_cross(w, t_dot, end->arm, f_dot, t_dot, code_variable("%sty", name.name));
    rows_write_cross(w, t_dot, end->v, f, t_dot, code_variable("%stz", name.name));
    rows_write_turned(w, end->G, end->D, 0, f, NULL, code_variable("%sgf", name.name));
    rows_write_turned(w, end->G + 3, end->D, 0, t, NULL, code_variable("%sgt", name.name));
    rows_write_turned(w, end->F, end->D, 0, f_dot, NULL, code_variable("%sff", name.name));
    rows_write_turned(w, end->F + 3, end->D, 0, t_dot, NULL, code_variable("%sft", name.name));
    for (int i = 0; i < 6; i++) {
      end->G[i].c *= sign;
      end->F[i].c *= sign;
    }
    for (int i = 0; i < 6; i++) {
      code_value *const F = &tree.link[end->link].F[i];
      code_begin(&s);
      code_add_one(&s, 1.0, *F);
      code_add_one(&s, 1.0, end->F[i]);
      if (i >= 3) {
        tree_add_cross(&s, 1.0, end->n, end->F, i - 3);
      }
      *F = code_end(w, &s, code_variable("%sF%s", name.name, code_rows[i]));
    }
  }
}

/* Loads of all loops on the bodies; velocities and q_dot are known. */
static void rows_write_loads(const code *w)
{
  fputs(constraint.n_loop > 0 ? "\n  /* E9.13: loads by the impulses of the loops */\n" : "", w->out);
  for (int j = 0; j < constraint.n_loop; j++) {
    rows_write_velocity(w, j, 0);
    rows_write_velocity(w, j, 1);
    rows_write_load(w, j);
  }
}

/* F less the turning of G at a node that moves (fbi_node_forces_add). */
static void rows_write_turning(const code *w, code_value load[6], const rows_end *end, code_value name)
{
  const code_value *const V = tree.link[end->link].V;
  code_sum s;
  for (int i = 0; i < 6; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, end->F[i]);
    tree_add_cross(&s, -1.0, V + 3, end->G + (i < 3 ? 0 : 3), i % 3);
    if (i >= 3) {
      tree_add_cross(&s, -1.0, end->at, end->G, i - 3);
    }
    load[i] = code_end(w, &s, code_variable("%sN%s", name.name, code_rows[i]));
  }
}

/* On the coordinates of a line, of which the gradient has what turns with the frame, too: J.(F - (0, v x P)). */
static void rows_add_line_node(const code *w, code_sum *force, const rows_end *end, code_value name)
{
  code_value load[6];
  code_sum s;
  for (int i = 0; i < 6; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, end->F[i]);
    if (i >= 3) {
      tree_add_cross(&s, -1.0, end->at, end->G, i - 3);
    }
    load[i] = code_end(w, &s, code_variable("%sN%s", name.name, code_rows[i]));
  }
  for (int a = 0; a < tree.link[end->link].n; a++) {
    code_add_one(&force[a], 1.0, end->pushed[a]);
    for (int i = 0; i < 3; i++) {
      code_add(&force[a], 1.0, end->Ju[a][i], load[i]);
      code_add(&force[a], 1.0, end->Jphi[a][i], load[3 + i]);
    }
  }
}

/* The same on its modes, added to the force on each: J.(F - turning of G) + J_dot.G. */
static void rows_add_node(const code *w, code_sum *force, const rows_end *end, int at, code_value name)
{
  const tree_link *const L = &tree.link[end->link];
  const fb_node *const node = &L->model->node[at];
  const code_value *const q_dot = L->rates.q_dot;
  code_value load[6], Ju_dot[FB_MAX_MODES][3], turn_dot[FB_MAX_MODES][3], phi_dot[3], shrink;
  code_sum s;
  if (node->line.line > 0) {
    rows_add_line_node(w, force, end, name);
    return;
  }
  rows_write_turning(w, load, end, name);
  rows_write_pairs(w, Ju_dot, L->model, NULL, rows_table(L->model, node, 0), q_dot, code_variable("%sJd", name.name));
  rows_write_pairs(w, turn_dot, L->model, NULL, rows_table(L->model, node, 1), q_dot, code_variable("%sTd", name.name));
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    for (int a = 0; a < L->n; a++) {
      code_add(&s, 1.0, end->turn[a][i], q_dot[a]);
    }
    phi_dot[i] = code_end(w, &s, code_variable("%spd%c", name.name, tree_axis[i]));
  }
  code_begin(&s);
  for (int i = 0; i < 3; i++) {
    code_add(&s, 0.5, end->phi[i], phi_dot[i]);
  }
  shrink = code_end(w, &s, code_variable("%ssh", name.name));
  for (int a = 0; a < L->n; a++) {
    code_add_one(&force[a], 1.0, end->pushed[a]);
    for (int i = 0; i < 3; i++) {
      code_value rate;
      code_add(&force[a], 1.0, end->Ju[a][i], load[i]);
      code_add(&force[a], 1.0, end->Jphi[a][i], load[3 + i]);
      code_add(&force[a], 1.0, Ju_dot[a][i], end->G[i]);
      code_begin(&s);
      code_add_one(&s, 1.0, turn_dot[a][i]);
      tree_add_cross(&s, 0.5, phi_dot, end->turn[a], i);
      tree_add_cross(&s, 0.5, end->phi, turn_dot[a], i);
      code_add(&s, -1.0, shrink, end->Jphi[a][i]);
      rate = code_end(w, &s, code_variable("%sx%d%c", name.name, a, tree_axis[i]));
      code_begin(&s);
      code_add(&s, 1.0, rate, end->scale);
      rate = code_end(w, &s, code_variable("%sy%d%c", name.name, a, tree_axis[i]));
      code_add(&force[a], 1.0, rate, end->G[3 + i]);
    }
  }
}

static void rows_add_modes(const code *w, code_sum *force, int k)
{
  for (int j = 0; j < constraint.n_loop; j++) {
    for (int side = 0; side < 2; side++) {
      const rows_end *const end = &constraint.loop[j].end[side];
      const fb_joint *const joint = constraint.loop[j].joint;
      if (end->link == k && end->moves) {
        rows_add_node(w, force, end, side == 1 ? joint->child_node : joint->parent_node,
                      code_variable("l%d_%d", j, side));
      }
    }
  }
}

/* ---- what rows left out say */

static void rows_write_root_of(const code *w, const code_value x[3])
{
  code inner = *w;
  code_sum s;
  inner.indent = 4;
  code_begin(&s);
  for (int i = 0; i < 3; i++) {
    code_add(&s, 1.0, x[i], x[i]);
  }
  code_settle(&s);
  code_template(w, "sqrt~(");
  code_template(w, w->lanes && s.n == 0 ? "%z + " : "");
  code_expression(&inner, &s, 40);
  fputs(")", w->out);
}

static void rows_write_norm(const code *w, const char *name, int k, const code_value x[3])
{
  fprintf(w->out, "    const %s %s_%d = ", code_real(w), name, k);
  rows_write_root_of(w, x);
  fputs(";\n", w->out);
}

/* The larger of two variables, into the first. */
static void tree_write_larger(const code *w, const char *most, const char *other, int k)
{
  if (w->lanes) {
    code_template(w, "    ");
    fprintf(w->out, "%s = ", most);
    code_template(w, "%W");
    fprintf(w->out, "%s > %s_%d, %s", most, other, k, most);
    code_template(w, "%! + %F");
    fprintf(w->out, "%s > %s_%d", most, other, k);
    code_template(w, "%:");
    fprintf(w->out, "%s_%d", other, k);
    code_template(w, "%;;\n");
  } else {
    fprintf(w->out, "    %s = %s > %s_%d ? %s : %s_%d;\n", most, most, other, k, most, other, k);
  }
}

/* The largest violation of a row: gap */
static void rows_write_gaps(const code *w)
{
  code_template(w, "    $ gap = %z;\n");
  for (int r = 0; r < constraint.n; r++) {
    if (!code_is_constant(&constraint.row[r].value)) {
      fprintf(w->out, "    const %s gap_%d = ", code_real(w), r);
      code_template(w, "fabs~(");
      fprintf(w->out, "%s);\n", constraint.row[r].value.name);
      tree_write_larger(w, "gap", "gap", r);
    }
  }
}

/* Tells rows that were left out and do not hold, where prescribed speeds can contradict them; `when`: a condition. */
static void rows_write_check(const code *w, const char *when)
{
  int n = 0;
  if (!rows_are_driven()) {
    return;
  }
  fprintf(w->out, "  if (%s", when);
  code_template(w, w->lanes ? "!%((" : "");
  for (int k = 0; k < tree.n; k++) {
    for (int a = 0; a < tree.link[k].axes; a++) {
      if (tree_is_driven(&tree.link[k], a)) {
        fputs(n++ > 0 ? " + " : "", w->out);
        code_template(w, "fabs~(");
        fprintf(w->out, "b%d_v_%d)", k, a);
      }
    }
  }
  for (int r = 0; r < constraint.n; r++) {
    const rows_row *const row = &constraint.row[r];
    if (row->axis >= 0 && constraint.loop[row->loop].joint->mode[row->axis] == FB_AXIS_PRESCRIBED) {
      fputs(n++ > 0 ? " + " : "", w->out);
      code_template(w, "fabs~(");
      fprintf(w->out, "l%d_r_%d)", row->loop, row->axis);
    }
  }
  code_template(w, w->lanes ? ") <= `0`%)) {\n    $ most[@_ROWS];\n" : " > `0`) {\n    $ most[@_ROWS];\n");
  for (int j = 0; j < 2 * constraint.n_loop; j++) {
    const rows_end *const end = &constraint.loop[j / 2].end[j % 2];
    if (end->link >= 0) {
      rows_write_norm(w, "speed", j, end->v);
      rows_write_norm(w, "spins", j, end->spin);
    }
  }
  for (int r = 0; r < constraint.n; r++) {
    const rows_row *const row = &constraint.row[r];
    code_template(w, row->acts >= 0 ? "    most[" : "");
    if (row->acts >= 0) {
      fprintf(w->out, "%d] = ", row->acts);
      code_template(w, "%z");
    }
    for (int s = 0; s < 2 && row->acts >= 0; s++) {
      if (constraint.loop[row->loop].end[s].link >= 0) {
        for (int m = 0; m < 2; m++) {
          fputs(" +\n      ", w->out);
          rows_write_root_of(w, m ? row->torque[s] : row->force[s]);
          fprintf(w->out, m ? " * spins_%d" : " * speed_%d", 2 * row->loop + s);
        }
      }
    }
    fputs(row->acts >= 0 ? ";\n" : "", w->out);
  }
  rows_write_gaps(w);
  code_template(w, "    if (!@_rows_hold(mu, Q, c, most, above, rough, gap)) {\n      return @_contradiction;\n    }\n"
                   "  }\n");
}

static const char rows_hold[] =
    "\n/* E9.10: do rows that were left out, which have no impulse, hold, c + Q mu = 0? They may miss, of what they "
    "are at\n"
    "   most, the angle at which they stand to the others and 1000 times the gap [m], [rad] of the loops, at most a\n"
    "   hundredth; and round-off of their terms, which is all that is left where loops stand still. */\n"
    "static int @_rows_hold(const $ *mu, const $ *Q, const $ *c, const $ *most, const $ *angle, const $ *rough, $ "
    "gap)\n{\n"
    "  int hold = 1;\n"
    "  for (int r = 0; r < @_ROWS; r++) {\n"
    "    $ miss = c[r], terms = sqrt~(rough[r]);\n"
    "    for (int i = 0; i < @_ROWS; i++) {\n"
    "      const $ term = Q[r * @_ROWS + i] * mu[i];\n"
    "      miss += term;\n"
    "      terms += fabs~(term);\n    }\n"
    "    miss = fabs~(miss) - @_lost * @_epsilon * terms;\n"
    "    hold &= %(((fabs~(mu[r]) > `0`) | ((miss <= @_loose * most[r]) &\n"
    "                                      (miss <= (`10` * angle[r] + `1000` * gap) * most[r])))%);\n  }\n"
    "  return hold;\n}\n";
#endif
