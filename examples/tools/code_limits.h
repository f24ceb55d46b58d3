/* code_limits.h - what rotors inside the bodies of a tree add to its step limit, E11.50, and what springs between points
   add, E11.42. Included by code_tree.h. */
#ifndef CODE_LIMITS_H
#define CODE_LIMITS_H

static int tree_has_rotors(void)
{
  int has = 0;
  for (int k = 0; k < tree.n; k++) {
    has |= tree.link[k].model->n_rotor > 0;
  }
  return has;
}

/* Momenta of root, axes and modes that move joints by the wrench of body k and, where that is open, what it does to its
   modes. */
static void tree_write_share(const code *w, code_value right[CODE_ROWS], code_value wrench[6], const code_value *modes,
                             const char *name, int k)
{
  char word[40];
  tree_nothing(right, CODE_ROWS);
  for (int a = 0; modes && a < tree.link[k].n && tree.link[k].open; a++) {
    right[tree.link[k].mode_row + a] = modes[a];
  }
  for (int j = k, from = -1; j >= 0; from = j, j = tree.link[j].parent) {
    const tree_link *const L = &tree.link[j];
    if (from >= 0) {
      code_value up[6];
      tree_nothing(up, 6);
      snprintf(word, sizeof word, "%s%c%d", name, 'f', from);
      tree_write_to_parent(w, up, &tree.link[from], wrench, word, k);
      memcpy(wrench, up, sizeof up);
      for (int a = 0; a < L->n && tree.link[from].moves; a++) {
        right[L->mode_row + a] = tree_write_along(w, tree_nodes[from].twist[a], wrench,
                                                  code_variable("b%d_%s_%d", k, name, L->mode_row + a));
      }
    }
    for (int a = 0; a < L->axes; a++) {
      right[L->row[a]] = tree_write_along(w, L->A[a], wrench, code_variable("b%d_%s_%d", k, name, L->row[a]));
    }
    for (int i = 0; i < 6 && j == tree.root; i++) {
      right[i] = wrench[i];
    }
  }
}

/* z = L^-1 of momenta */
static void tree_write_forward(const code *w, const code_factor *f, const int *order, code_value z[CODE_ROWS],
                               const code_value right[CODE_ROWS], const char *name, int k)
{
  code_sum s;
  for (int i = 0; i < f->n; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, right[order[i]]);
    for (int m = 0; m < i; m++) {
      code_add(&s, -1.0, f->low[i][m], z[m]);
    }
    z[i] = code_end(w, &s, code_variable("b%d_%sz_%d", k, name, i));
  }
}

/* Both, of one wrench. */
static void tree_write_unit(const code *w, const code_factor *f, const int *order, code_value z[CODE_ROWS],
                            code_value wrench[6], const code_value *modes, const char *name, int k)
{
  code_value right[CODE_ROWS];
  tree_write_share(w, right, wrench, modes, name, k);
  tree_write_forward(w, f, order, z, right, name, k);
}

/* s += z D^-1 y */
static void tree_add_unit(const code *w, code_sum *s, const code_factor *f, const code_value z[CODE_ROWS],
                          const code_value y[CODE_ROWS], const char *name, int k)
{
  for (int i = 0; i < f->n; i++) {
    code_sum one;
    code_value product;
    code_begin(&one);
    code_add(&one, 1.0, z[i], y[i]);
    product = code_end(w, &one, code_variable("b%d_%s_%d", k, name, i));
    code_add(s, 1.0, f->share[i], product);
  }
}

/* Are rotors r and i on the same section? */
static int tree_same_section(const fb_body *body, int r, int i)
{
  const fb_rotor *const a = &body->rotor[r], *const b = &body->rotor[i];
  return a->moves == b->moves && (!a->moves || a->node == b->node);
}

/* Rotation of the section of rotor r by coordinates, J_i = turn^T B(e_i), about axis i. */
static void tree_write_section(const code *w, code_value J[3][FB_MAX_MODES], int r)
{
  for (int i = 0; i < 3; i++) {
    code_value unit[3], bent[3];
    char name[16];
    code_sum s;
    tree_nothing(unit, 3);
    unit[i] = code_constant(1.0);
    snprintf(name, sizeof name, "e%d", i);
    code_write_rotor_bent(w, bent, unit, name, r);
    for (int a = 0; a < w->n; a++) {
      code_begin(&s);
      for (int j = 0; j < 3; j++) {
        code_add(&s, 1.0, code_rotor.turn[r][j][a], bent[j]);
      }
      J[i][a] = code_end(w, &s, code_variable("r%d_J%d_%d", r, i, a));
    }
  }
}

/* W: mobility of the section of rotor r of body k in the whole: r^T M^-1 r, and of its own modes J M^-1 J^T unless they
   are speeds of the tree. */
static void tree_write_mobility(const code *w, const code_factor *f, const int *order, code_value W[6], int r, int k)
{
  static code_value z[3][CODE_ROWS], J[3][FB_MAX_MODES], turned[3][FB_MAX_MODES];
  const tree_link *const L = &tree.link[k];
  const int moves = L->model->rotor[r].moves;
  char name[16];
  code_sum s;
  for (int i = 0; i < 3; i++) {
    for (int a = 0; a < FB_MAX_MODES; a++) {
      J[i][a] = turned[i][a] = code_constant(0.0);
    }
  }
  if (moves) {
    code own = tree_enter(w, k);
    own.indent = w->indent;
    code_rotor = tree_rotors[k];
    tree_write_section(&own, J, r);
    for (int i = 0; i < 3 && !L->open; i++) {
      snprintf(name, sizeof name, "r%d_MJ%d", r, i);
      code_write_solve(&own, turned[i], J[i], name);
    }
    tree_leave(k);
  }
  for (int i = 0; i < 3; i++) {
    code_value wrench[6];
    for (int j = 0; j < 6; j++) {
      code_begin(&s);
      code_add_one(&s, j == 3 + i ? 1.0 : 0.0, code_constant(1.0));
      for (int a = 0; a < L->n && moves; a++) {
        code_add(&s, -1.0, L->rates.lambda[j][a], turned[i][a]);
      }
      wrench[j] = code_end(w, &s, code_variable("b%d_r%d_F%d%d", k, r, i, j));
    }
    snprintf(name, sizeof name, "r%du%d", r, i);
    tree_write_unit(w, f, order, z[i], wrench, J[i], name, k);
  }
  for (int e = 0; e < 6; e++) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    code_begin(&s);
    snprintf(name, sizeof name, "r%dw%d", r, e);
    tree_add_unit(w, &s, f, z[row[e]], z[column[e]], name, k);
    for (int a = 0; a < L->n && moves; a++) {
      code_add(&s, 1.0, J[row[e]][a], turned[column[e]][a]);
    }
    W[e] = code_end(w, &s, code_variable("b%d_r%d_W%d", k, r, e));
  }
}

static const int tree_packed[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}}; /* elements of W */

/* H.adj(W) H as bK_rR_square, of which the root is the frequency of nutation. */
static void tree_write_square(const code *w, const code_value W[6], const code_value H[3], int r, int k)
{
  code_value y[3];
  code_sum s;
  for (int a = 0; a < 3; a++) { /* rows of adj(W) */
    code_begin(&s);
    for (int b = 0; b < 3; b++) {
      const int i = (a + 1) % 3, j = (a + 2) % 3, l = (b + 1) % 3, m = (b + 2) % 3;
      code_value minor;
      code_sum one;
      code_begin(&one);
      code_add(&one, 1.0, W[tree_packed[i][l]], W[tree_packed[j][m]]);
      code_add(&one, -1.0, W[tree_packed[i][m]], W[tree_packed[j][l]]);
      minor = code_end(w, &one, code_variable("b%d_r%d_M%d%d", k, r, a, b));
      code_add(&s, 1.0, minor, H[b]);
    }
    y[a] = code_end(w, &s, code_variable("b%d_r%d_y%d", k, r, a));
  }
  code_begin(&s);
  for (int a = 0; a < 3; a++) {
    code_add(&s, 1.0, H[a], y[a]);
  }
  code_declare(w, &s, code_variable("b%d_r%d_square", k, r).name);
}

/* E11.50 of the rotors on the section of rotor r of body k. */
static void tree_write_rotor_spin(const code *w, const code_factor *f, const int *order, int r, int k)
{
  const fb_body *const body = tree.link[k].model;
  const code_rotors *const own = &tree_rotors[k];
  code_value W[6], H[3];
  code_sum s, spin;
  tree_write_mobility(w, f, order, W, r, k);
  code_begin(&spin);
  for (int i = r; i < body->n_rotor; i++) {
    const fb_rotor *const rotor = &body->rotor[i];
    const double slope = (double)rotor->damping +
                         (rotor->friction > FB_R(0.0) ? (double)rotor->friction / (double)rotor->friction_speed : 0.0);
    if (!tree_same_section(body, r, i) || !(slope > 0.0)) {
      continue;
    }
    code_add_one(&spin, slope / (double)rotor->inertia, code_constant(1.0));
    for (int a = 0; a < 3; a++) {
      code_begin(&s);
      for (int b = 0; b < 3; b++) {
        code_add(&s, 1.0, W[tree_packed[a][b]], own->axis[i][b]);
      }
      code_add(&spin, slope, own->axis[i][a], code_end(w, &s, code_variable("b%d_r%d_Wa%d", k, i, a)));
    }
  }
  for (int a = 0; a < 3; a++) {
    code_begin(&s);
    for (int i = r; i < body->n_rotor; i++) {
      if (tree_same_section(body, r, i)) {
        code_add(&s, 1.0, own->axis[i][a], own->momentum[i]);
      }
    }
    H[a] = code_end(w, &s, code_variable("b%d_r%d_H%d", k, r, a));
  }
  tree_write_square(w, W, H, r, k);
  code_declare(w, &spin, code_variable("b%d_r%d_brake", k, r).name);
  fprintf(w->out, "    nutation += b%d_r%d_brake + ", k, r);
  code_template(w, "`0.5` * sqrt~(%W");
  fprintf(w->out, "b%d_r%d_square", k, r);
  code_template(w, " > `0`%,");
  fprintf(w->out, "b%d_r%d_square", k, r);
  code_template(w, "%!);\n");
}

/* What all of them add to the fastest rotation, in `nutation`. */
static void tree_write_nutation(const code *w, const code_factor *f, const int *order)
{
  code_template(w, "    $ nutation = %z;\n");
  for (int k = 0; k < tree.n; k++) {
    const fb_body *const body = tree.link[k].model;
    for (int r = 0; r < body->n_rotor; r++) {
      int known = 0;
      for (int i = 0; i < r; i++) {
        known |= tree_same_section(body, r, i);
      }
      if (!known) {
        tree_write_rotor_spin(w, f, order, r, k);
      }
    }
  }
}

/* Momenta by a unit force along axis i of the common body on the point of a side of spring j, in `right`; what it does to
   the modes e of its body and, unless that is open, M^-1 of it. */
static void spans_write_side(const code *w, code_value right[CODE_ROWS], code_value e[FB_MAX_MODES],
                             code_value bent[FB_MAX_MODES], int i, int side, int j)
{
  const struct tree_span *const span = &tree_spans[j];
  const int k = span->end[side].link, n = k >= 0 ? tree.link[k].n : 0;
  code_value force[3], wrench[6];
  char name[24];
  code_sum s;
  tree_nothing(right, CODE_ROWS);
  tree_nothing(e, FB_MAX_MODES);
  tree_nothing(bent, FB_MAX_MODES);
  for (int c = 0; c < 3; c++) {
    force[c] = span->R[side][3 * i + c];
    force[c].c *= side ? -1.0 : 1.0;
  }
  for (int a = 0; a < n && span->end[side].moves; a++) {
    code_begin(&s);
    for (int c = 0; c < 3; c++) {
      code_add(&s, 1.0, span->slope[side][a][c], force[c]);
    }
    e[a] = code_end(w, &s, code_variable("e%d_%de%d_%d", j, side, i, a));
  }
  if (n > 0 && span->end[side].moves && !tree.link[k].open) {
    code own = tree_enter(w, k);
    own.indent = w->indent;
    snprintf(name, sizeof name, "e%d_%dM%d", j, side, i);
    code_write_solve(&own, bent, e, name);
    tree_leave(k);
  }
  for (int c = 0; c < 6 && k >= 0; c++) {
    code_begin(&s);
    if (c < 3) {
      code_add_one(&s, 1.0, force[c]);
    } else {
      tree_add_cross(&s, 1.0, span->point[side], force, c - 3);
    }
    for (int a = 0; a < n; a++) {
      code_add(&s, -1.0, tree.link[k].rates.lambda[c][a], bent[a]);
    }
    wrench[c] = code_end(w, &s, code_variable("e%d_%dw%d_%d", j, side, i, c));
  }
  if (k >= 0) {
    snprintf(name, sizeof name, "e%d_%du%d", j, side, i);
    tree_write_share(w, right, wrench, e, name, k);
  }
}

/* The same of both points, in z = L^-1 of the momenta. */
static void spans_write_unit(const code *w, const code_factor *f, const int *order, code_value z[CODE_ROWS],
                             code_value e[2][FB_MAX_MODES], code_value bent[2][FB_MAX_MODES], int i, int j)
{
  const rows_end *const end = tree_spans[j].end;
  code_value right[2][CODE_ROWS];
  char name[24];
  code_sum s;
  spans_write_side(w, right[0], e[0], bent[0], i, 0, j);
  spans_write_side(w, right[1], e[1], bent[1], i, 1, j);
  for (int c = 0; c < CODE_ROWS; c++) {
    code_begin(&s);
    code_add_one(&s, 1.0, right[0][c]);
    code_add_one(&s, 1.0, right[1][c]);
    right[0][c] = code_end(w, &s, code_variable("e%d_r%d_%d", j, i, c));
  }
  for (int a = 0; a < FB_MAX_MODES && end[0].link == end[1].link; a++) { /* modes of one body know both */
    code_begin(&s);
    code_add_one(&s, 1.0, e[0][a]);
    code_add_one(&s, 1.0, e[1][a]);
    e[0][a] = e[1][a] = code_end(w, &s, code_variable("e%d_both%d_%d", j, i, a));
  }
  snprintf(name, sizeof name, "e%du%d", j, i);
  tree_write_forward(w, f, order, z, right[0], name, 0);
}

/* E11.42 of spring j, in `elastic` and `damped`: W the mobility of its points, k d.W d + (T/l) (tr W - d.W d), c d.W d. */
static void spans_write_bound(const code *w, const code_factor *f, const int *order, int j)
{
  static code_value z[3][CODE_ROWS], e[3][2][FB_MAX_MODES], bent[3][2][FB_MAX_MODES];
  const fb_spring *const spring = &tree.system->spring[j];
  const int bare = spans_is_bare(j);
  const int plain = spans_is_plain(j); /* T/l is known where the points meet, and W along nothing is 0 */
  code_value W;
  char name[24], stiffness[40], damping[40];
  code_sum s, along, trace;
  code_begin(&along);
  code_begin(&trace);
  for (int i = 0; i < 3; i++) {
    spans_write_unit(w, f, order, z[i], e[i], bent[i], i, j);
    for (int l = bare ? i : 0; l <= i; l++) {
      code_sum one;
      snprintf(name, sizeof name, "e%dw%d%d", j, i, l);
      code_begin(&s);
      tree_add_unit(w, &s, f, z[i], z[l], name, 0);
      for (int a = 0; a < 2 * FB_MAX_MODES; a++) {
        code_add(&s, 1.0, e[i][a % 2][a / 2], bent[l][a % 2][a / 2]);
      }
      W = code_end(w, &s, code_variable("e%d_W%d%d", j, i, l));
      code_add_one(&trace, i == l ? 1.0 : 0.0, W);
      if (!bare) {
        code_begin(&one);
        code_add(&one, 1.0, W, tree_spans[j].along[l]);
        W = code_end(w, &one, code_variable("e%d_Wd%d%d", j, i, l));
        code_add(&along, i == l ? 1.0 : 2.0, W, tree_spans[j].along[i]);
      }
    }
  }
  code_declare(w, &trace, code_variable("e%d_trace", j).name);
  code_number(stiffness, w, (double)spring->stiffness);
  code_number(damping, w, (double)spring->damping);
  if (bare) {
    fprintf(w->out, "    stiffening += %s * e%d_trace;\n", stiffness, j);
    return;
  }
  code_declare(w, &along, code_variable("e%d_mobile", j).name);
  fputs("    stiffening += ", w->out);
  if (spring->stiffness > FB_R(0.0)) {
    fprintf(w->out, "%s * e%d_mobile + ", stiffness, j);
  }
  code_template(w, "fabs~(");
  if (plain) {
    fprintf(w->out, "%s + e%d_pull * e%d_share) * (e%d_trace - e%d_mobile);\n", stiffness, j, j, j, j);
    return;
  }
  fprintf(w->out, "e%d_tension) * e%d_share * (e%d_trace - e%d_mobile);\n", j, j, j, j);
  if (spring->damping > FB_R(0.0)) {
    fprintf(w->out, "    damped += %s * e%d_mobile;\n", damping, j);
  }
}
#endif
