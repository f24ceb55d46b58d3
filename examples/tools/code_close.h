/* code_close.h - brings loops back onto their constraints after a step: see code_rows.h, part of code_tree.h. */
#ifndef CODE_CLOSE_H
#define CODE_CLOSE_H

/* ---- after a step: positions and momenta onto the constraints */

static const char rows_move_head[] =
    "\n/* What brings the vector x onto the constraints. places: the coordinates, by E9.17, where momenta are zero; "
    "else the\n"
    "   momenta, by E9.10. */\n"
    "static @_NOINLINE @_status @_rows_move($ *move, const $ *x, const @_input *in, int places)\n{\n"
    "  $ closes = %z;\n"
    "  $ Q[@_ROWS * @_ROWS], c[@_ROWS], above[@_ROWS], mu[@_ROWS];\n"
    "  closes += places ? `1` : `0`;\n";

/* The momenta of a joint's axes by the impulses. */
static void rows_write_axes(const code *w, int k)
{
  const tree_link *const L = &tree.link[k];
  code_value p[3];
  code_sum s;
  code inner = *w;
  inner.indent = 4;
  for (int a = 0; a < L->axes; a++) {
    code_begin(&s);
    for (int r = 0; r < constraint.n && tree_is_free(L, a); r++) {
      code_add(&s, 1.0, rows_mu(r), constraint.row[r].direct[L->row[a]]);
    }
    p[a] = code_end(&inner, &s, code_variable("b%d_dp_%d", k, a));
  }
  if (tree_is_ball(L) && L->free > 0) {
    code_value child[9];
    tree_constants(child, L->joint->child_axes, 9);
    tree_write_turned(&inner, p, child, 0, p, "mb", k);
    tree_write_view(&inner, p, p, "mg", k, 0);
  }
  for (int a = 0; a < tree_momenta_of(L); a++) {
    char target[32];
    code_begin(&s);
    code_add_one(&s, 1.0, p[a]);
    snprintf(target, sizeof target, "move[%d]", L->p + a);
    code_assign(&inner, &s, target);
  }
}

/* The momenta of a link's modes by the impulses. */
static void rows_write_modes(const code *w, int k)
{
  const tree_link *const L = &tree.link[k];
  code_sum s;
  code inner = *w;
  inner.indent = 4;
  for (int a = 0; a < L->n; a++) {
    char target[32];
    code_begin(&s);
    if (!L->open) {
      rows_add(&s, 1.0, k, a, rows_pushed);
    }
    for (int r = 0; r < constraint.n && L->open; r++) {
      code_add(&s, 1.0, rows_mu(r), constraint.row[r].direct[L->mode_row + a]);
    }
    snprintf(target, sizeof target, "move[%d]", L->pi + a);
    code_assign(&inner, &s, target);
  }
}

/* Attitude of the free root and, where that of P is integrated, how far it goes. */
static void rows_write_root_displaced(const code *w)
{
  const code_value *const V = tree.link[tree.root].V;
  code_sum s;
  tree_write_quat_rate(w, "move", 0, V + 3);
  code_template(w, "    $ step[3];\n");
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, V[i]);
    code_assign(w, &s, code_variable("step[%d]", i).name);
  }
  code_template(w, "    @_turn(move + @_PLACE, x, step);\n");
}

/* P and L of the free root by the impulses from the ground. */
static void rows_write_root_momenta(const code *w)
{
  code inner = *w;
  code_sum s;
  inner.indent = 4;
  code_template(w, "    $ push[6];\n");
  for (int i = 0; i < 6; i++) {
    code_begin(&s);
    for (int r = 0; r < constraint.n; r++) {
      code_add(&s, 1.0, rows_mu(r), constraint.row[r].direct[i]);
    }
    code_assign(&inner, &s, code_variable("push[%d]", i).name);
  }
  code_template(w, "    @_turn(move + @_P, x, push);\n    @_turn(move + @_L, x, push + 3);\n");
}

/* The coordinates of a joint and of modes by the displacements. */
static void rows_write_displaced(const code *w, int k)
{
  const tree_link *const L = &tree.link[k];
  code inner = *w;
  char target[32];
  code_sum s;
  inner.indent = 4;
  if (tree_is_ball(L) && L->free > 0) {
    tree_write_quat_rate(&inner, "move", L->x, L->u);
  } else if (k == tree.root) {
    rows_write_root_displaced(&inner);
  }
  for (int a = 0; a < L->axes + L->n; a++) {
    const int mode = a - L->axes;
    if (mode >= 0 || (!tree_is_ball(L) && tree_is_free(L, a))) {
      code_begin(&s);
      code_add_one(&s, 1.0, mode < 0 ? L->u[a] : L->rates.q_dot[mode]);
      snprintf(target, sizeof target, "move[%d]", mode < 0 ? L->x + a : L->q + mode);
      code_assign(&inner, &s, target);
    }
  }
}

/* Are the loops closed, to 1e-5 (single: 1e-3) of the size of the whole? */
static void rows_write_gap(const code *w)
{
  code_value R[FB_MAX_BODIES][9], rho[FB_MAX_BODIES][3];
  code inner = *w;
  char number[40];
  inner.indent = 4;
  code_template(w, "    $ size = %z;\n");
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    if (k == tree.root && tree.tied) {
      for (int i = 0; i < 9; i++) {
        R[k][i] = code_variable("R[%d]", i);
        rho[k][i % 3] = code_variable("x[%d]", L->p + 6 + i % 3);
      }
    } else if (k == tree.root) {
      rows_unit(R[k]);
      tree_nothing(rho[k], 3);
    } else if (L->parent < 0) {
      memcpy(R[k], L->C, sizeof R[k]);
      memcpy(rho[k], L->s, sizeof rho[k]);
    } else {
      rows_write_turned(&inner, rho[k], R[L->parent], 0, L->s, rho[L->parent], code_variable("b%d_rho", k));
      rows_write_product(&inner, R[k], R[L->parent], 0, L->C, code_variable("b%d_R", k));
    }
    tree_write_norm(w, "far", k, rho[k]);
    tree_write_larger(w, "size", "far", k);
  }
  rows_write_gaps(w);
  code_number(number, w, w->single ? 1e-3 : 1e-5);
  code_template(w, "    if (!%((gap <= ");
  fprintf(w->out, "%s * (", number);
  code_template(w, "`1` + size))%)) {\n      return @_contradiction;\n    }\n");
}

static void rows_write_move(const code *w, int unused)
{
  (void)unused;
  code_template(w, rows_move_head);
  code_template(w, rows_are_driven() ? "  $ rough[@_ROWS];\n" : "");
  tree_write_names(w);
  tree_write_given_names(w, "in && !places");
  code_template(w, rows_are_driven() ? "" : "  (void)in;\n");
  if (tree.looped) {
    tree_write_pushed(w);
  }
  tree_write_places(w, LARGE_MOVING);
  tree.spins = "in && !places";
  tree_write_bodies(w);
  tree.spins = "in";
  tree_write_inertias(w);
  tree_write_solve(w, 1);
  for (int k = 0; k < tree.n; k++) {
    tree_write_velocity(w, k);
    tree_write_q_dot(w, k);
  }
  fputs("  if (places) {\n", w->out);
  for (int k = 0; k < tree.n; k++) {
    rows_write_displaced(w, k);
  }
  fputs("  } else {\n", w->out);
  for (int k = 0; k < tree.n; k++) {
    rows_write_axes(w, k);
    rows_write_modes(w, k);
  }
  if (tree.tied) {
    rows_write_root_momenta(w);
  }
  rows_write_gap(w);
  fputs("  }\n", w->out);
  for (int j = 0; j < 2 * constraint.n_loop && rows_are_driven(); j++) {
    rows_write_velocity(w, j / 2, j % 2);
  }
  rows_write_check(w, "!places && ");
  code_template(w, "  return @_ok;\n}\n");
}

static const char rows_close_head[] =
    "\n/* E9.17, E9.10: the vector d onto the constraints, positions first, then momenta. */\n"
    "static @_status @_close($ *d, const @_input *in)\n{\n"
    "  $ still[@_N], move[@_N];\n"
    "  @_status status;\n"
    "  memset(move, 0, sizeof move);\n"
    "  memcpy(still, d, sizeof still);\n";

/* What of link k is at rest where positions are closed; what moves, then. */
static void rows_still(const code *w, int at, int n, int k, const char *member)
{
  (void)k;
  if (member[0] == 'p' || strcmp(member, "rotor_momentum") == 0) {
    fprintf(w->out, "  memset(still + %d, 0, %d * sizeof *still);\n", at, n);
  }
}

static void rows_moved(const code *w, int at, int n, const char *member, int places)
{
  if ((member[0] != 'p') == places && member[0] != 'r') {
    fprintf(w->out, "  for (int i = %d; i < %d; i++) {\n    d[i] += move[i];\n  }\n", at, at + n);
  }
  if (places && strcmp(member, "quat") == 0) {
    code_template(w, "  size = `1` / sqrt~(");
    fprintf(w->out, "d[%d] * d[%d] + d[%d] * d[%d] + d[%d] * d[%d] + d[%d] * d[%d]);\n", at, at, at + 1, at + 1, at + 2,
            at + 2, at + 3, at + 3);
    fprintf(w->out, "  for (int i = %d; i < %d; i++) {\n    d[i] *= size;\n  }\n", at, at + 4);
  }
}

static void rows_placed(const code *w, int at, int n, int k, const char *member)
{
  (void)k;
  rows_moved(w, at, n, member, 1);
}

static void rows_pushed_on(const code *w, int at, int n, int k, const char *member)
{
  if (k != tree.root || tree.tied || strcmp(member, "p") != 0) { /* rows within the tree leave its momentum */
    rows_moved(w, at, n, member, 0);
  }
}

/* L about the displaced O */
static const char rows_moved_root[] =
    "  for (int i = 0; i < 3; i++) {\n"
    "    const int y = i == 2 ? 0 : i + 1, z = i == 0 ? 2 : i - 1;\n"
    "    d[@_L + i] += d[@_P + y] * move[@_PLACE + z] - d[@_P + z] * move[@_PLACE + y];\n";

static void rows_write_close(const code *w)
{
  code_template(w, rows_close_head);
  code_template(w, tree_has_joint(FB_JOINT_SPHERICAL) || tree.looped ? "  $ size;\n" : "");
  for (int k = 0; k < tree.n; k++) {
    tree_pieces(w, k, rows_still);
  }
  code_template(w, "  status = @_rows_move(move, still, in, 1);\n  if (status != @_ok) {\n    return status;\n  }\n");
  for (int k = 0; k < tree.n; k++) {
    tree_pieces(w, k, rows_placed);
  }
  if (tree.looped) {
    code_template(w, rows_moved_root);
    code_template(w, tree.stands ? "    d[@_PLACE + i] += move[@_PLACE + i];\n  }\n" : "  }\n");
  }
  code_template(w, "  status = @_rows_move(move, d, in, 0);\n");
  for (int k = 0; k < tree.n; k++) {
    tree_pieces(w, k, rows_pushed_on);
  }
  fputs("  return status;\n}\n", w->out);
}

/* The solution lane by lane: which rows are independent may differ. */
static void rows_write_lanes(const code *w)
{
  code_template(w, "\nstatic void @_rows_solve($ *mu, $ *Q, const $ *c, $ *bound)\n{\n");
  fprintf(w->out, "  for (int k = 0; k < %s_LANES; k++) {\n", w->name);
  code_template(
      w, "    %s own[@_ROWS], matrix[@_ROWS * @_ROWS], rest[@_ROWS], above[@_ROWS];\n"
         "    for (int i = 0; i < @_ROWS * @_ROWS; i++) {\n"
         "      matrix[i] = i %% @_ROWS > i / @_ROWS ? `0` : Q[i][k];\n    }\n"
         "    for (int i = 0; i < @_ROWS; i++) {\n      rest[i] = c[i][k];\n      above[i] = bound[i][k];\n    }\n");
  fprintf(w->out, "    %s_rows_solve(own, matrix, rest, above);\n", w->name);
  code_template(
      w, "    for (int i = 0; i < @_ROWS * @_ROWS; i++) {\n      Q[i][k] = matrix[i];\n    }\n"
         "    for (int i = 0; i < @_ROWS; i++) {\n      mu[i][k] = own[i];\n      bound[i][k] = above[i];\n    }\n"
         "  }\n}\n");
  code_template(w, rows_are_driven() ? rows_hold : "");
}

/* Sizes, kinds of rows (fbi_rows_alike) and the solution of their equations. */
static void rows_write_functions(const code *w)
{
  int n = 0;
  if (w->lanes) {
    rows_write_lanes(w);
    return;
  }
  code_template(w, "\nenum { @_ROWS = ");
  fprintf(w->out, "%d };\n", constraint.acting);
  code_template(w, "static const int @_kind[@_ROWS] = {");
  for (int r = 0; r < constraint.n; r++) {
    if (constraint.row[r].acts >= 0) {
      fprintf(w->out, n++ > 0 ? ", %d" : "%d", 2 * constraint.row[r].loop + rows_pushes(constraint.row[r].hold));
    }
  }
  code_template(w, w->single ? "};\nstatic const $ @_across = `1e-10`, @_apart = `1e-4`, @_equal = `1.001`,\n  @_along "
                               "= `1e-4`, @_heavy = `1.0`"
                             : "};\nstatic const $ @_across = `1e-20`, @_apart = `1e-8`, @_equal = `1.000001`,\n  "
                               "@_along = `1e-8`, @_heavy = `1e-4`");
  code_template(w, !rows_are_driven() ? ";\n"
                   : w->single        ? ",\n  @_loose = `0.1`, @_lost = `1e2`, @_epsilon = `1.1920929e-7`;\n"
                               : ",\n  @_loose = `0.01`, @_lost = `1e4`, @_epsilon = `2.220446049250313e-16`;\n");
  code_template(w, rows_functions);
  code_template(w, rows_are_driven() ? rows_angles : "");
  fputs("}\n", w->out);
  code_template(w, rows_are_driven() ? rows_hold : "");
}
#endif
