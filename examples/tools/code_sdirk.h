/* code_sdirk.h - the L-stable step of a tree, two stages of SDIRK, in the words of code_tree.h: the equations, iterations
   and checks of fb_system_sdirk_step. Part of code_tree.h, which includes it.

   A stage is solved by Newton corrections of fixed number (E11.13), each of a function that evaluates the rates and goes
   on with the residual r = f - k: (M + g C + g^2 K) z = g r_p - g^2 K r_v. Positions, Lambda and S are those of the
   evaluation; modes are eliminated within their body by E = M + g C + g^2 K, of S is left
   S + Lambda (M^-1 - E^-1) Lambda^T, summed from the tips and factored as M is; modes that move a joint have g C + g^2 K
   in their rows of the matrix (code_node.h). Loops hold in each correction, A z = 0, by the rows of the evaluation and
   the factors of this matrix (code_impulse.h). Names of the correction begin with n. */
#ifndef CODE_SDIRK_H
#define CODE_SDIRK_H

typedef struct sdirk_link {
  code_factor E;                            /* of the modes */
  code_value right[FB_MAX_MODES];           /* their right side */
  code_value K[3], gK[3], g2K[3], C[3];     /* stiffness of the axes, by g, by g^2; damping */
  code_value turn[3], dq_dot[FB_MAX_MODES]; /* residual of a spherical joint's turn; z of the modes */
} sdirk_link;

static sdirk_link sdirk[FB_MAX_BODIES];

/* Residual of a number of the vector. */
static code_value sdirk_rest(int at)
{
  return code_plain("res_%d", at);
}

static code_value sdirk_g(double c, int square)
{
  code_value g = code_plain(square ? "g2" : "g");
  g.c = c;
  return g;
}

/* c x y by a name of its own where it is not a number times one of both. */
static code_value sdirk_write_times(const code *w, code_value x, code_value y, code_value name)
{
  code_sum s;
  if (code_is_constant(&x) || code_is_constant(&y)) {
    const double c = x.c * y.c;
    code_value v = code_is_constant(&x) ? y : x;
    v.c = c;
    return fabs(c) > 0.0 ? v : code_constant(0.0);
  }
  code_begin(&s);
  code_add(&s, 1.0, x, y);
  return code_end(w, &s, name);
}

/* Place of the speed of axis a of link k in the vector, which is prescribed and has a value; -1: it is not. */
static int sdirk_given_at(int k, int a)
{
  int at = tree.given;
  for (int j = 0; j <= k; j++) {
    const tree_link *const L = &tree.link[j];
    for (int i = 0; i < (j < k ? L->axes : a); i++) {
      at += tree_is_driven(L, i) && tree_is_valued(L);
    }
  }
  return tree_is_driven(&tree.link[k], a) && tree_is_valued(&tree.link[k]) ? at : -1;
}

/* ---- modes */

/* y = E^-1 x; tag: of its names. */
static void sdirk_write_eliminated(const code *w, int k, code_value *y, const code_value *x, const char *tag)
{
  static char names[CODE_ROWS][CODE_NAME], prefix[CODE_NAME];
  const char *const before = code_of_names;
  code_factor *const f = &sdirk[k].E;
  snprintf(prefix, sizeof prefix, "nb%d%s_", k, tag);
  code_of_names = prefix;
  for (int a = 0; a < f->n; a++) {
    f->y[a] = x[a];
    snprintf(names[a], CODE_NAME, "x_%d", a);
  }
  code_write_substitution(w, f, names);
  memcpy(y, f->x, (size_t)f->n * sizeof *y);
  code_of_names = before;
}

/* Right side of the modes of a body, g r_p - g^2 K r_v. */
static void sdirk_write_right(const code *w, int k)
{
  static double K[FB_MAX_MODES][FB_MAX_MODES], C[FB_MAX_MODES][FB_MAX_MODES];
  const tree_link *const L = &tree.link[k];
  code_sum s;
  code_read_springs(K, C, L->model);
  for (int a = 0; a < L->n; a++) {
    code_begin(&s);
    code_add(&s, 1.0, sdirk_g(1.0, 0), sdirk_rest(L->pi + a));
    for (int b = 0; b < L->n; b++) {
      code_add(&s, -1.0, sdirk_g(K[a][b], 1), sdirk_rest(L->q + b));
    }
    sdirk[k].right[a] = code_end(w, &s, code_variable("right_%d", a));
  }
}

/* E of a body and its factors. */
static void sdirk_write_E(const code *w, int k)
{
  static double M[FB_MAX_MODES][FB_MAX_MODES], K[FB_MAX_MODES][FB_MAX_MODES], C[FB_MAX_MODES][FB_MAX_MODES];
  const fb_body *const body = tree.link[k].model;
  code_factor *const f = &sdirk[k].E;
  code_sum s;
  code_read_sparse(M, &body->M, body->n);
  code_read_springs(K, C, body);
  f->n = body->n;
  for (int a = 0; a < body->n; a++) {
    snprintf(f->label[a], sizeof f->label[a], "%d", a);
    for (int b = 0; b <= a; b++) {
      code_begin(&s);
      code_add_one(&s, M[a][b], code_constant(1.0));
      code_add_one(&s, 1.0, sdirk_g(C[a][b], 0));
      code_add_one(&s, 1.0, sdirk_g(K[a][b], 1));
      f->S[a][b] = f->S[b][a] = code_end(w, &s, code_variable("E_%d_%d", a, b));
    }
  }
  for (int a = 0; a < body->n; a++) {
    code_write_pivot(w, f, a);
    code_write_column(w, f, a);
  }
}

/* Do E and M^-1 couple mode a with no other one? */
static int sdirk_is_alone(int k, int a)
{
  int alone = 1;
  for (int b = 0; b < sdirk[k].E.n; b++) {
    alone = alone && (b == a || (code_is_zero(&sdirk[k].E.S[a][b]) && !(fabs(code_model.W[a][b]) > 0.0)));
  }
  return alone;
}

/* soft = (M^-1 - E^-1) Lambda^T, row i of Lambda. */
static void sdirk_write_soft(const code *w, int k, code_value soft[6][FB_MAX_MODES])
{
  const code_factor *const f = &sdirk[k].E;
  code_value share[FB_MAX_MODES], x[FB_MAX_MODES];
  code_sum s;
  int alone = 1;
  for (int a = 0; a < f->n; a++) {
    alone = alone && sdirk_is_alone(k, a);
  }
  for (int a = 0; a < f->n && alone; a++) {
    code_begin(&s);
    code_add_one(&s, code_model.W[a][a], code_constant(1.0));
    code_add_one(&s, -1.0, f->share[a]);
    share[a] = code_end(w, &s, code_variable("soft_%d", a));
  }
  for (int i = 0; i < 6; i++) {
    const code_value *const row = code_now.lambda[i];
    if (!alone) {
      char tag[8];
      snprintf(tag, sizeof tag, "r%d", i);
      sdirk_write_eliminated(w, k, x, row, tag);
    }
    for (int a = 0; a < f->n; a++) {
      if (alone) {
        soft[i][a] = sdirk_write_times(w, share[a], row[a], code_variable("t%d_%d", i, a));
        continue;
      }
      code_begin(&s);
      for (int b = 0; b < f->n; b++) {
        code_add_one(&s, code_model.W[a][b], row[b]);
      }
      code_add_one(&s, -1.0, x[a]);
      soft[i][a] = code_end(w, &s, code_variable("t%d_%d", i, a));
    }
  }
}

/* Inertia and momentum at rest of a body, its modes eliminated; of an open one M_rr and nothing. */
static void sdirk_write_body(const code *w, int k)
{
  tree_link *const L = &tree.link[k];
  const code own = tree_enter(w, k);
  code_value soft[6][FB_MAX_MODES], x[FB_MAX_MODES];
  code_sum s;
  memcpy(L->I, L->open ? tree_nodes[k].M_rr : code_now.S, sizeof L->I);
  tree_nothing(L->b, 6);
  snprintf(tree_prefix, sizeof tree_prefix, "nb%d_", k);
  sdirk_write_right(&own, k);
  if (L->n > 0 && !L->open) {
    sdirk_write_E(&own, k);
    sdirk_write_soft(&own, k, soft);
    sdirk_write_eliminated(&own, k, x, sdirk[k].right, "p");
    for (int e = 0; e < 21; e++) {
      code_begin(&s);
      code_add_one(&s, 1.0, code_now.S[e]);
      for (int a = 0; a < L->n; a++) {
        code_add(&s, 1.0, soft[fbi_sym6_row[e]][a], code_now.lambda[fbi_sym6_column[e]][a]);
      }
      L->I[e] = code_end(&own, &s, code_variable("S_%s_%s", code_rows[fbi_sym6_row[e]], code_rows[fbi_sym6_column[e]]));
    }
    for (int i = 0; i < 6; i++) {
      code_begin(&s);
      for (int a = 0; a < L->n; a++) {
        code_add(&s, 1.0, code_now.lambda[i][a], x[a]);
      }
      L->b[i] = code_end(&own, &s, code_variable("B_%s", code_rows[i]));
    }
  }
  tree_leave(k);
}

/* ---- axes of joints */

/* Stiffness and damping of an axis; with friction and stops as secants at the evaluation, as fbi_axes_soften. */
static void sdirk_write_stiffness(const code *w, int k, int a)
{
  const fb_joint *const joint = tree.link[k].joint;
  const double friction = (double)joint->friction[a], stiffness = (double)joint->stop_stiffness[a];
  const double loss = stiffness > 0.0 ? (double)joint->stop_loss[a] : 0.0;
  code_value *const K = &sdirk[k].K[a], *const C = &sdirk[k].C[a];
  char of[CODE_NAME];
  code_sum s;
  snprintf(of, sizeof of, "b%d_x_%d", k, a);
  *K = code_constant((double)joint->stiffness[a]);
  *C = code_constant((double)joint->damping[a]);
  if (stiffness > 0.0) {
    tree_template(w, loss > 0.0 ? "" : "  const $ #stop = %z + `1`;\n", of);
    tree_template(w, "  const $ #firm = (%W#deep < `0`%,#stop%!) + (%W#deep > `0`%,#stop%!);\n", of);
    tree_template(w, loss > 0.0 ? "  const $ #size = fabs~(#deep);\n" : "", of);
    code_begin(&s);
    code_add_one(&s, 1.0, *K);
    code_add_one(&s, stiffness, code_variable("b%d_x_%d_firm", k, a));
    *K = code_end(w, &s, code_variable("b%d_x_%d_k", k, a));
  }
  code_begin(&s);
  code_add_one(&s, 1.0, *C);
  code_add_one(&s, loss * stiffness, code_variable("b%d_x_%d_size", k, a));
  code_add_one(&s, friction > 0.0 ? 1.0 : 0.0, code_variable("b%d_x_%d_rub", k, a));
  *C = code_end(w, &s, code_variable("b%d_x_%d_c", k, a));
  sdirk[k].gK[a] = sdirk_write_times(w, *K, sdirk_g(1.0, 0), code_variable("b%d_x_%d_gk", k, a));
  sdirk[k].g2K[a] = sdirk_write_times(w, *K, sdirk_g(1.0, 1), code_variable("b%d_x_%d_ggk", k, a));
}

/* E4.4: component i of the turn whose quaternion has a rate, 2 quat^* o rate, own axes. */
static void sdirk_add_turn(code_sum *s, int at, const code_value rate[4], int i)
{
  const int y = (i + 1) % 3, z = (i + 2) % 3;
  code_value quat[4];
  for (int j = 0; j < 4; j++) {
    quat[j] = code_variable("x[%d]", at + j);
  }
  code_add(s, 2.0, quat[0], rate[1 + i]);
  code_add(s, -2.0, quat[1 + i], rate[0]);
  code_add(s, -2.0, quat[1 + y], rate[1 + z]);
  code_add(s, 2.0, quat[1 + z], rate[1 + y]);
}

/* E4.4: s += component i of the rate of the quaternion at a place by an angular velocity v, own axes, 1/2 quat o (0, v) */
static void sdirk_add_quat_rate(code_sum *s, int at, const code_value v[3], int i)
{
  code_value quat[4];
  for (int j = 0; j < 4; j++) {
    quat[j] = code_variable("x[%d]", at + j);
  }
  for (int j = 0; j < 3 && i == 0; j++) {
    code_add(s, -0.5, quat[1 + j], v[j]);
  }
  if (i > 0) {
    const int y = i % 3, z = (i + 1) % 3;
    code_add(s, 0.5, quat[0], v[i - 1]);
    code_add(s, 0.5, quat[1 + y], v[z]);
    code_add(s, -0.5, quat[1 + z], v[y]);
  }
}

/* Residual momenta of a spherical joint along its axes, and its turn. */
static void sdirk_write_ball_rest(const code *w, code_value m[3], int k)
{
  const tree_link *const L = &tree.link[k];
  code_value rest[4], child[9];
  code_sum s;
  for (int i = 0; i < 4; i++) {
    rest[i] = sdirk_rest(L->x + i);
  }
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    sdirk_add_turn(&s, L->x, rest, i);
    sdirk[k].turn[i] = code_end(w, &s, code_variable("b%d_nturn_%d", k, i));
    m[i] = sdirk_rest(L->p + i);
  }
  tree_constants(child, L->joint->child_axes, 9);
  tree_write_view(w, m, m, "nh", k, 1);
  tree_write_turned(w, m, child, 1, m, "nhj", k);
}

/* The matrix and right side of the axes of link k. */
static void sdirk_write_axes(const code *w, int k)
{
  const tree_link *const L = &tree.link[k];
  const int ball = tree_is_ball(L);
  code_value m[3];
  code_sum s;
  if (ball && L->free > 0) {
    sdirk_write_ball_rest(w, m, k);
  }
  for (int a = 0; a < L->axes; a++) {
    const int row = L->row[a];
    if (!tree_is_free(L, a)) {
      tree_right[row] = code_constant(0.0);
      continue;
    }
    sdirk_write_stiffness(w, k, a);
    code_begin(&s);
    code_add_one(&s, 1.0, tree_matrix[row][row]);
    code_add(&s, 1.0, sdirk_g(1.0, 0), sdirk[k].C[a]);
    code_add_one(&s, 1.0, sdirk[k].g2K[a]);
    tree_matrix[row][row] = code_end(w, &s, code_variable("nD_%d", row));
    code_begin(&s);
    code_add(&s, 1.0, sdirk_g(1.0, 0), ball ? m[a] : sdirk_rest(L->p + a));
    code_add(&s, -1.0, sdirk[k].g2K[a], ball ? sdirk[k].turn[a] : sdirk_rest(L->x + a));
    for (int i = 0; i < 6; i++) {
      code_add(&s, -1.0, L->A[a][i], L->b[i]);
    }
    tree_right[row] = code_end(w, &s, code_variable("ny_%d", row));
  }
}

/* The matrix of the modes of an open body, of which M is there already. */
static void sdirk_write_open(const code *w, int k)
{
  static double K[FB_MAX_MODES][FB_MAX_MODES], C[FB_MAX_MODES][FB_MAX_MODES];
  const tree_link *const L = &tree.link[k];
  code_sum s;
  code_read_springs(K, C, L->model);
  for (int a = 0; a < L->n; a++) {
    for (int b = 0; b <= a; b++) {
      code_value *const H = &tree_matrix[L->mode_row + b][L->mode_row + a];
      code_begin(&s);
      code_add_one(&s, 1.0, *H);
      code_add_one(&s, 1.0, sdirk_g(C[a][b], 0));
      code_add_one(&s, 1.0, sdirk_g(K[a][b], 1));
      *H = code_end(w, &s, code_variable("nE_%d_%d", L->mode_row + a, L->mode_row + b));
      tree_matrix[L->mode_row + a][L->mode_row + b] = *H;
    }
  }
}

/* The matrix and right side of a free root. */
static void sdirk_write_root(const code *w)
{
  const tree_link *const L = &tree.link[tree.root];
  code_sum s;
  for (int i = 0; i < 6; i++) {
    code_value turned;
    code_begin(&s);
    for (int j = 0; j < 3; j++) {
      code_add(&s, 1.0, code_variable("R[%d]", 3 * j + i % 3), sdirk_rest(L->p + i - i % 3 + j));
    }
    turned = code_end(w, &s, code_variable("nP_%d", i));
    code_begin(&s);
    code_add(&s, 1.0, sdirk_g(1.0, 0), turned);
    code_add_one(&s, -1.0, L->b[i]);
    tree_right[i] = code_end(w, &s, code_variable("ny_%d", i));
    for (int j = 0; j < 6; j++) {
      tree_matrix[i][j] = L->I[fb_sym6_index(i, j)];
    }
  }
}

/* Velocities of the bodies and speeds of their modes by z. */
static void sdirk_write_speeds(const code *w)
{
  code_sum s;
  for (int k = 0; k < tree.n; k++) {
    tree_link *const L = &tree.link[k];
    code_value e[FB_MAX_MODES];
    tree_write_velocity(w, k);
    memcpy(sdirk[k].dq_dot, tree_right + L->mode_row, (size_t)(L->open ? L->n : 0) * sizeof *tree_right);
    for (int a = 0; a < L->n && !L->open; a++) {
      code_begin(&s);
      code_add_one(&s, 1.0, sdirk[k].right[a]);
      for (int i = 0; i < 6; i++) {
        code_add(&s, -1.0, L->rates.lambda[i][a], L->V[i]);
      }
      rows_add(&s, 1.0, k, a, rows_pushed);
      e[a] = code_end(w, &s, code_variable("b%d_e_%d", k, a));
    }
    if (!L->open) {
      sdirk_write_eliminated(w, k, sdirk[k].dq_dot, e, "z");
    }
  }
}

/* Speeds z of the root, the axes and, by the velocities of their bodies, of the modes. */
static void sdirk_write_solve(const code *w)
{
  static char names[CODE_ROWS][CODE_NAME];
  const int n = (tree.root >= 0 ? 6 : 0) + tree.n_axis + tree.n_open;
  int order[CODE_ROWS];
  for (int i = 0; i < n + tree.n_given; i++) {
    tree_nothing(tree_matrix[i], n + tree.n_given);
  }
  code_of_names = "n";
  for (int k = 0; k < tree.n; k++) {
    for (int a = 0; a < tree.link[k].axes; a++) {
      if (tree_is_free(&tree.link[k], a)) {
        tree_write_column(w, k, a);
      }
    }
    if (tree.link[k].open) {
      node_write_modes(w, k);
      node_write_right(w, k, sdirk[k].right);
    }
  }
  code_of_names = "";
  for (int k = 0; k < tree.n; k++) {
    sdirk_write_axes(w, k);
    if (tree.link[k].open) {
      sdirk_write_open(w, k);
    }
  }
  if (tree.root >= 0) {
    sdirk_write_root(w);
  }
  code_of_names = "n";
  tree_write_factors(w, order, names, n);
  if (constraint.n > 0) {
    constraint.by = sdirk_write_eliminated;
    for (int k = 0; k < tree.n; k++) {
      memcpy(tree.link[k].rates.pi, sdirk[k].right, sizeof sdirk[k].right);
    }
    rows_write_solve(w, &code_solver, order, names, 0);
    constraint.by = NULL;
  } else {
    code_write_substitution(w, &code_solver, names);
  }
  for (int i = 0; i < n; i++) {
    tree_right[order[i]] = code_solver.x[i];
  }
  sdirk_write_speeds(w);
  code_of_names = "";
}

/* ---- the correction */

static void sdirk_take(const code *w, code_sum *s, int at)
{
  code_assign(w, s, code_variable("rate[%d]", at).name);
}

/* dk_v = r_v + z, dk_p = r_p - g K dk_v - C z of the modes of link k. */
static void sdirk_take_modes(const code *w, int k)
{
  static double K[FB_MAX_MODES][FB_MAX_MODES], C[FB_MAX_MODES][FB_MAX_MODES];
  const tree_link *const L = &tree.link[k];
  code_value move[FB_MAX_MODES];
  code_sum s;
  code_read_springs(K, C, L->model);
  for (int a = 0; a < L->n; a++) {
    code_begin(&s);
    code_add_one(&s, 1.0, sdirk_rest(L->q + a));
    code_add_one(&s, 1.0, sdirk[k].dq_dot[a]);
    move[a] = code_end(w, &s, code_variable("b%d_dq_%d", k, a));
    tree_assign_one(w, move[a], L->q + a);
  }
  for (int a = 0; a < L->n; a++) {
    code_begin(&s);
    code_add_one(&s, 1.0, sdirk_rest(L->pi + a));
    for (int b = 0; b < L->n; b++) {
      code_add(&s, -1.0, sdirk_g(K[a][b], 0), move[b]);
      code_add_one(&s, -C[a][b], sdirk[k].dq_dot[b]);
    }
    sdirk_take(w, &s, L->pi + a);
  }
}

/* The same of a spherical joint, its momenta in inertial axes. */
static void sdirk_take_ball(const code *w, int k)
{
  const tree_link *const L = &tree.link[k];
  code_value move[4], torque[3];
  code_sum s;
  for (int i = 0; i < 4; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, sdirk_rest(L->x + i));
    sdirk_add_quat_rate(&s, L->x, L->u, i);
    move[i] = code_end(w, &s, code_variable("b%d_dquat_%d", k, i));
    tree_assign_one(w, move[i], L->x + i);
  }
  for (int i = 0; i < 3; i++) {
    code_value turn;
    code_begin(&s);
    sdirk_add_turn(&s, L->x, move, i);
    turn = code_end(w, &s, code_variable("b%d_dturn_%d", k, i));
    code_begin(&s);
    code_add(&s, -1.0, sdirk[k].gK[i], turn);
    code_add(&s, -1.0, sdirk[k].C[i], L->u[i]);
    torque[i] = code_end(w, &s, code_variable("b%d_dtau_%d", k, i));
  }
  tree_write_out_of_ball(w, torque, "nt", "nv", k);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, sdirk_rest(L->p + i));
    code_add_one(&s, 1.0, torque[i]);
    sdirk_take(w, &s, L->p + i);
  }
}

/* Of one that is prescribed or locked. */
static void sdirk_take_given_ball(const code *w, int k)
{
  const tree_link *const L = &tree.link[k];
  for (int i = 0; i < 4; i++) {
    tree_assign_one(w, L->driven > 0 ? sdirk_rest(L->x + i) : code_constant(0.0), L->x + i);
  }
}

static void sdirk_take_axes(const code *w, int k)
{
  const tree_link *const L = &tree.link[k];
  code_sum s;
  if (tree_is_ball(L)) {
    (L->free > 0 ? sdirk_take_ball : sdirk_take_given_ball)(w, k);
    return;
  }
  for (int a = 0; a < L->axes; a++) {
    code_value move;
    if (!tree_is_free(L, a)) { /* nothing of it changes in a step */
      continue;
    }
    code_begin(&s);
    code_add_one(&s, 1.0, sdirk_rest(L->x + a));
    code_add_one(&s, 1.0, L->u[a]);
    move = code_end(w, &s, code_variable("b%d_dx_%d", k, a));
    tree_assign_one(w, move, L->x + a);
    code_begin(&s);
    code_add_one(&s, 1.0, sdirk_rest(L->p + a));
    code_add(&s, -1.0, sdirk[k].gK[a], move);
    code_add(&s, -1.0, sdirk[k].C[a], L->u[a]);
    sdirk_take(w, &s, L->p + a);
  }
}

/* Attitude, momenta in inertial axes and place of a free root; h is not integrated. */
static void sdirk_take_root(const code *w)
{
  const tree_link *const L = &tree.link[tree.root];
  code_value move[3], P[3];
  code_sum s;
  for (int i = 0; i < 4; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, sdirk_rest(i));
    sdirk_add_quat_rate(&s, 0, L->V + 3, i);
    sdirk_take(w, &s, i);
  }
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    for (int j = 0; j < 3; j++) {
      code_add(&s, 1.0, code_variable("R[%d]", 3 * i + j), L->V[j]);
    }
    move[i] = code_end(w, &s, code_variable("nmove_%d", i));
    P[i] = code_variable("x[%d]", L->p + i);
  }
  for (int i = 0; i < 3; i++) {
    tree_assign_one(w, code_constant(0.0), TREE_OWN + i);
    tree_assign_one(w, sdirk_rest(L->p + i), L->p + i);
    code_begin(&s);
    code_add_one(&s, 1.0, sdirk_rest(L->p + 3 + i));
    tree_add_cross(&s, 1.0, P, move, i);
    sdirk_take(w, &s, L->p + 3 + i);
    code_begin(&s);
    code_add_one(&s, 1.0, sdirk_rest(L->p + 6 + i));
    code_add_one(&s, tree.stands ? 1.0 : 0.0, move[i]);
    sdirk_take(w, &s, L->p + 6 + i);
    if (tree.tracked) {
      code_begin(&s);
      code_add_one(&s, 1.0, sdirk_rest(L->p + TREE_PUSHED + i));
      code_add_one(&s, 1.0, move[i]);
      sdirk_take(w, &s, L->p + TREE_PUSHED + i);
      tree_assign_one(w, code_constant(0.0), L->p + TREE_PUSHED + 3 + i);
    }
  }
}

/* E11.51 of the rotors of link k: friction -c s as at the end of the stage, dh = r_h/(1 + g rate c/most), c at most
   `most`; angle r + g dh / inertia. */
static void sdirk_take_rotors(const code *w, int k)
{
  const tree_link *const L = &tree.link[k];
  for (int r = 0; r < L->model->n_rotor; r++) {
    const fb_rotor *const rotor = &L->model->rotor[r];
    const double dry = rotor->friction > FB_R(0.0) ? (double)rotor->friction / (double)rotor->friction_speed : 0.0;
    const double slows = rotor->given ? 0.0 : (double)rotor->damping + dry;
    const code_value kept = code_variable("b%d_r%d_dh", k, r);
    code_value held;
    code_sum s;
    if (!(slows > 0.0)) {
      tree_assign_one(w, sdirk_rest(L->spun + r), L->spun + r);
      tree_assign_one(w, sdirk_rest(L->angle + r), L->angle + r);
      continue;
    }
    code_begin(&s);
    code_add_one(&s, 1.0, code_constant(1.0));
    code_add_one(&s, (double)rotor->rate * (double)rotor->damping / slows, sdirk_g(1.0, 0));
    code_add(&s, dry > 0.0 ? (double)rotor->rate / slows : 0.0, sdirk_g(1.0, 0), code_variable("b%d_r%d_rub", k, r));
    held = code_end(w, &s, code_variable("b%d_r%d_held", k, r));
    fprintf(w->out, "  const %s %s = %s / %s;\n", code_real(w), kept.name, sdirk_rest(L->spun + r).name, held.name);
    tree_assign_one(w, kept, L->spun + r);
    code_begin(&s);
    code_add_one(&s, 1.0, sdirk_rest(L->angle + r));
    code_add(&s, 1.0 / (double)rotor->inertia, sdirk_g(1.0, 0), kept);
    sdirk_take(w, &s, L->angle + r);
  }
}

static const char sdirk_correct_head[] =
    "\n/* E11.13: correction `rate` of the rates k of a stage at the vector x under what acts; w: angular velocities "
    "of "
    "the bodies. */\n"
    "static @_NOINLINE @_status @_correct(%M$ *rate, $ *w, const $ *k, const $ *x, const @_input *in, %s part)\n{\n%V"
    "  const int pushed = 1;\n";

static void sdirk_write_correct(const code *w, int unused)
{
  (void)unused;
  code_template(w, sdirk_correct_head);
  code_template(w, w->lanes ? "  const $ g = %z + part;\n" : "  const $ g = part;\n");
  code_template(w, "  const $ g2 = g * g;\n");
  tree_write_evaluation(w);
  for (int k = 0; k < tree.n; k++) {
    for (int a = 0; a < tree.link[k].axes; a++) {
      if (sdirk_given_at(k, a) >= 0) {
        tree_assign_one(w, code_variable("b%d_v_%d", k, a), sdirk_given_at(k, a));
      }
    }
  }
  fputs("\n  /* residual f - k */\n", w->out);
  for (int i = 0; i < tree.size; i++) {
    fprintf(w->out, "  const %s res_%d = rate[%d] - k[%d];\n", code_real(w), i, i, i);
  }
  fputs("\n  /* E11.13: E = M + g C + g^2 K of the modes; S and momentum at rest that they leave */\n", w->out);
  for (int k = 0; k < tree.n; k++) {
    sdirk_write_body(w, k);
  }
  code_of_names = "n";
  tree_write_inertias(w);
  code_of_names = "";
  fputs("\n  /* (M + g C + g^2 K) z = g r_p - g^2 K r_v */\n", w->out);
  sdirk_write_solve(w);
  fputs("\n  /* dk_v = r_v + z, dk_p = r_p - g K dk_v - C z */\n", w->out);
  for (int k = 0; k < tree.n; k++) {
    sdirk_take_rotors(w, k);
    sdirk_take_modes(w, k);
    sdirk_take_axes(w, k);
  }
  if (tree.root >= 0) {
    sdirk_take_root(w);
  }
  for (int i = tree.work >= 0 ? tree.work : tree.given; i < tree.size; i++) { /* and speeds of prescribed axes */
    tree_assign_one(w, sdirk_rest(i), i);
  }
  code_template(w, "  return @_ok;\n}\n");
}

/* ---- what is around it */

/* Of lines: s k.M k by the mass matrix of the undeformed body. */
static void sdirk_add_square(code_sum *bent, double s, int k)
{
  static double M[FB_MAX_MODES][FB_MAX_MODES];
  const tree_link *const L = &tree.link[k];
  code_read_sparse(M, &L->model->M, L->n);
  for (int a = 0; a < L->n; a++) {
    for (int b = 0; b <= a; b++) {
      code_add(bent, (a == b ? 1.0 : 2.0) * s * M[a][b], code_variable("k[%d]", L->q + a),
               code_variable("k[%d]", L->q + b));
    }
  }
}

/* E11.24 of link k: what its joint and its modes add to both sums. */
static void sdirk_add_size(const code *w, code_sum *moved, code_sum *bent, int k)
{
  const tree_link *const L = &tree.link[k];
  const double gyration = (double)L->model->gyration, size = gyration > 0.0 ? 1.0 / gyration : 1.0;
  const int ball = k == tree.root || tree_is_ball(L);
  code_sum s;
  char name[24];
  for (int i = 0; i < (ball ? 4 : L->axes); i++) {
    const code_value x = code_variable("k[%d]", !ball && tree_is_driven(L, i) ? sdirk_given_at(k, i) : L->x + i);
    const int slides = !ball && i == fbi_traits(L->joint)->slide;
    code_add(moved, ball ? 4.0 : L->joint->mode[i] == FB_AXIS_LOCKED ? 0.0 : slides ? size * size : 1.0, x, x);
  }
  if (large_is(L->model)) {
    sdirk_add_square(bent, size * size / (double)L->model->mass, k);
    return;
  }
  code_begin(&s);
  for (int a = 0; a < L->n; a++) {
    code_add_one(&s, (double)L->model->reach[a], tree_write_size(w, "k", k, a));
  }
  if (L->n > 0) {
    snprintf(name, sizeof name, "bent_%d", k);
    code_declare(w, &s, name);
    code_add(bent, size * size, code_variable("%s", name), code_variable("%s", name));
  }
}

static void sdirk_write_size(const code *w)
{
  static code_sum moved, bent;
  code_template(w, "\n/* E11.24: squared size of the increment g k [rad^2]; bent: that of the modes */\n"
                   "static void @_size($ *moved, $ *bent, const $ *k, %s g)\n{\n");
  code_begin(&moved);
  code_begin(&bent);
  for (int k = 0; k < tree.n; k++) {
    sdirk_add_size(w, &moved, &bent, k);
  }
  code_declare(w, &moved, "turned");
  code_declare(w, &bent, "all");
  code_template(w, "  (void)k;\n  *moved = g * g * turned;\n  *bent = g * g * all;\n}\n");
}

/* What acts at the first stage. */
static void sdirk_write_between(const code *w)
{
  code_template(w, "\nstatic void @_between(@_input *in, const @_input *a, const @_input *b, %s c)\n{\n  *in = *a;\n  "
                   "(void)b, (void)c;\n");
  for (int k = 0; k < tree_parts(); k++) {
    for (int m = 0; m < TREE_INPUTS; m++) {
      if (tree_input_size(k, m) > 0) {
        const char *const name = tree_input_name(m), *const part = tree_part(k);
        fprintf(w->out, "  for (int i = 0; i < %d; i++) {\n", tree_input_size(k, m));
        fprintf(w->out, "    in->%s.%s[i] += c * (b->%s.%s[i] - a->%s.%s[i]);\n  }\n", part, name, part, name, part,
                name);
      }
    }
  }
  for (int j = 0; j < tree.system->n_spring; j++) {
    if (spans_is_pulled(j)) {
      fprintf(w->out, "  in->pull_%d += c * (b->pull_%d - a->pull_%d);\n", j, j, j);
    }
  }
  fputs("}\n", w->out);
}

static const char sdirk_declarations[] =
    "void @_start(@_state *state);\n"
    "/* Corrections of a stage, 1 to 8; of the first one more. */\n"
    "#ifndef @_ITERATIONS\n#define @_ITERATIONS 2\n#endif\n"
    "/* One step of SDIRK of order 2, L-stable, dt [s], under what acts at its start and end. Refused: the state stays "
    "as "
    "it was. */\n"
    "@_status @_step(@_state *state, const @_input *start, const @_input *end, $ dt);\n";

static const char sdirk_stage[] =
    "\n/* E11.13: the rates k of a stage, so that k = f(base + g k), from their first guess. */\n"
    "static @_status @_stage(%M$ *k, const $ *first, const $ *base, const @_input *in, %s g, %s dt, int n)\n{\n%V"
    "  $ at[@_N], rate[@_N]%Z, w[3 * @_BODIES], bent = %z, bent_all, begins = %z, before = %z, last = %z, change;\n"
    "  @_status status = @_ok;\n";

static const char sdirk_stage_loop[] =
    "  for (int j = 0; j < n && status == @_ok; j++) {\n"
    "    for (int i = 0; i < @_N; i++) {\n      at[i] = base[i] + g * k[i];\n    }\n";

static const char sdirk_stage_end[] = "    for (int i = 0; i < @_N; i++) {\n      k[i] += rate[i];\n    }\n"
                                      "    before = last;\n    @_size(&last, &bent, rate, g);\n"
                                      "    if (j == 0) {\n      begins = last;\n    }\n  }\n"
                                      "  if (status != @_ok) {\n    return status;\n  }\n";

/* E11.25: a correction that is small by one of its bounds is; of modes the next one, too. */
static const char sdirk_stage_check[] =
    "\n  /* E11.25 */\n"
    "  @_size(&change, &bent_all, k, g);\n"
    "  if (n > 1 && !%(((last > `1e-2` * begins) & (last > `1e-4` * change) & (last > floor)) == 0%)) {\n"
    "    return @_convergence;\n  }\n";
static const char sdirk_modes_check[] =
    "  $ deflection, next;\n  @_size(&begins, &deflection, at, `1`);\n"
    "  next = `4` * change * bent;\n  deflection *= `1e-7`;\n  last *= bent;\n  change *= `1e-13`;\n"
    "  if (n > 1 && !%(((bent > `1e-2` * bent_all) & (bent > least) &\n"
    "                 ((last > before * deflection) | (next > deflection)) &\n"
    "                 ((last > before * change) | (last > `1e-13` * before) | (next > change) | (next > `1e-13`))) == "
    "0%)) {\n"
    "    return @_convergence;\n  }\n";

/* E11.25 of the momenta of rotors. */
static const char sdirk_settled[] =
    "    if (n > 1 && !%((fabs~(g * rate[i]) > `0.01` * fabs~(g * k[i]) + root * fabs~(at[i]) + @_tiny) == 0%)) {\n"
    "      return @_convergence;\n    }\n  }\n";

/* of E11.25, by precision; root: of the rounding */
static const char *const sdirk_floors[2] = {
    "  const %s floor = `2.220446049250313e-18`, least = `7.888609052210118e-31`;\n",
    "  const %s floor = `1.1920929e-9`, least = `2.2737367544323206e-13`;\n"};
static const char *const sdirk_roots[2] = {"  const %s root = `1.4901161193847656e-8`;\n",
                                           "  const %s root = `3.4526698e-4`;\n"};

static const char sdirk_step_head[] =
    "\n/* E11.14 */\n"
    "%S@_status @_step(%M@_state *state, const @_input *start, const @_input *end, %s dt)\n{\n"
    "  const %s c = `0.29289321881345248`, g = c * dt, ahead = (`1` - c) * dt;\n"
    "  const @_input *in = start;\n  @_input between;\n"
    "  $ x[@_N], base[@_N], k[@_N]%Z, sum[@_N], first[3 * @_BODIES]";

static const char sdirk_step_begin[] =
    "  @_status status = @_ok;\n"
    "  if (!state || (start != NULL) != (end != NULL)%Q) {\n    return @_null;\n  }\n"
    "  if (!(dt > `0` && dt < @_huge)) {\n    return @_value;\n  }\n"
    "  if (!@_input_is_finite(start) || !@_input_is_finite(end)) {\n    return @_not_finite;\n  }\n"
    "  @_enter(x, state);\n"
    "  if (start != end) {\n    @_between(&between, start, end, c);\n    in = &between;\n  }\n";

static const char sdirk_step_limits[] = "\n  /* step limit at the start */\n"
                                        "  status = @_rates_at(%Asum, first, &longest, x, start, 1);\n"
                                        "  status = status == @_ok && !%((dt <= longest)%) ? @_step_length : status;\n";

static const char sdirk_step_rest[] =
    "  status = status == @_ok ? @_stage(%Ak, first, x, in, g, dt, @_ITERATIONS + 1) : status;\n"
    "  if (status != @_ok) {\n    return status;\n  }\n"
    "  for (int i = 0; i < @_N; i++) {\n    sum[i] = ahead * k[i];\n    base[i] = x[i] + ahead * k[i];\n  }\n"
    "  status = @_stage(%Ak, first, base, end, g, dt, @_ITERATIONS);\n"
    "  if (status != @_ok) {\n    return status;\n  }\n"
    "  for (int i = 0; i < @_N; i++) {\n    sum[i] += g * k[i];\n  }\n";

static const char sdirk_drives[] = "  status = @_drives_check(state, start, NULL, end, dt);\n"
                                   "  if (status != @_ok) {\n    return status;\n  }\n";

/* The frame moves from the first guess on. */
static const char sdirk_tracked[] = "  memcpy(k + @_WHERE, x + @_FRAME, 3 * sizeof *k);\n";

/* The functions of code_tree.h in place of its rates. 0: there is no temporary file, see errno. */
static int sdirk_write_functions(const code *w)
{
  int good = !tree.limited || code_write_pruned(w, tree_write_rates, 0);
  tree.limited = 0;
  good = code_write_pruned(w, sdirk_write_correct, 0) && good;
  tree.limited = !tree.system->allow_long_step;
  sdirk_write_size(w);
  sdirk_write_between(w);
  return good;
}

static void sdirk_write_stage(const code *w)
{
  const int limited = !tree.system->allow_long_step;
  int bends = 0;
  code_template(w, sdirk_stage);
  code_template(w, sdirk_floors[w->single]);
  code_template(w, tree.n_rotor > 0 ? sdirk_roots[w->single] : "");
  code_template(w, w->lanes ? "  memset(rate, 0, sizeof rate);\n" : "");
  code_template(w, sdirk_stage_loop);
  code_template(w, tree.root >= 0 ? "    @_turn_back(at + 4, at, at + @_L);\n" : "");
  code_template(w, "    status = @_correct(%Arate, w, k, at, in, g);\n");
  if (limited) {
    code_template(w, "    if (j == n - 1 && status == @_ok) {\n      int far = 0;\n");
    code_template(w, tree_step_turns);
    code_template(w, "      status = far ? @_step_length : @_ok;\n    }\n");
  }
  code_template(w, sdirk_stage_end);
  code_template(w, limited ? "" : "  (void)first, (void)dt;\n");
  code_template(w, tree.root >= 0 && !tree.stands
                       ? "  for (int i = 0; i < 3; i++) {\n    k[@_PLACE + i] = base[@_P + i] + g "
                         "* k[@_P + i];\n  }\n"
                       : "");
  code_template(w, sdirk_stage_check);
  for (int k = 0; k < tree.n; k++) {
    bends |= tree.link[k].n > 0;
  }
  code_template(w, bends ? sdirk_modes_check : "  (void)bent, (void)bent_all, (void)least, (void)before;\n");
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    if (L->model->n_rotor > 0) {
      fprintf(w->out, "  for (int i = %d; i < %d; i++) {\n", L->spun, L->spun + L->model->n_rotor);
      code_template(w, sdirk_settled);
    }
  }
  code_template(w, "  return @_ok;\n}\n");
}

static void sdirk_write_step(const code *w)
{
  sdirk_write_stage(w);
  code_template(w, sdirk_step_head);
  code_template(w, tree.system->allow_long_step ? "%Z" : ", longest = %z");
  code_template(w, tree_leads() ? ", center[3];\n" : ";\n");
  code_template(w, sdirk_step_begin);
  if (w->lanes) {
    code_template(w, "  memset(k, 0, sizeof k);\n  memset(sum, 0, sizeof sum);\n  memset(first, 0, sizeof first);\n");
  }
  code_template(w, tree.tracked ? sdirk_tracked : "");
  code_template(w, tree_is_told() ? sdirk_drives : "");
  code_template(w, !tree_leads() ? ""
                   : tree.flown  ? "  @_center(%Acenter, x, start);\n"
                                 : "  @_center(%Acenter, x);\n");
  code_template(w, tree.system->allow_long_step ? "" : sdirk_step_limits);
  code_template(w, sdirk_step_rest);
  tree_write_given_momenta(w);
  fputs("  return ", w->out);
  code_template(w, tree.n_valued > 0 ? "@_drives_take(state, end, @_end(%Astate, sum, x" : "@_end(%Astate, sum, x");
  code_template(w, tree_leads() ? ", center, dt, 1" : "");
  code_template(w, constraint.n > 0 || tree.flown ? ", end)" : ")");
  code_template(w, tree.n_valued > 0 ? ");\n}\n" : ";\n}\n");
}
#endif
