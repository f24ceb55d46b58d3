/* code_hold.h - nodes on lines that carry something (E14.14, E9.25), in the words of code_line.h: where they are, how fast
   they move with each coordinate, and what momenta there do to the coordinates. Part of code_line.h. */
#ifndef CODE_HOLD_H
#define CODE_HOLD_H

static unsigned code_held, code_carrying; /* bits of the nodes of the body that bear a load; momenta, too */

/* The next node on this line, from k on, of those in `of`; -1: none. */
static int code_hold_next(unsigned of, int k)
{
  for (; k < code_model.body->n_node; k++) {
    if (of >> k & 1u && code_model.body->node[k].line.line > 0 &&
        &code_line.all->line[code_model.body->node[k].line.line - 1] == code_line.line) {
      return k;
    }
  }
  return -1;
}

static const fb_line_node *code_hold_at(int k)
{
  return &code_model.body->node[k].line;
}

/* The point before a node on the line, -1: none. */
static int code_hold_after(int k)
{
  return code_hold_at(k)->after ? code_hold_at(k)->after - 1 - code_line.line->point : -1;
}

/* l->h<k>_<name>[i] */
static code_value code_hold_field(int k, const char *name, int i)
{
  return code_variable("l->h%d_%s[%d]", k, name, i);
}

static void code_hold_keep(const code *w, code_sum *s, int k, const char *name, int i, int n)
{
  code_member(code_variable("h%d_%s[%d]", k, name, n).name);
  code_assign(w, s, code_hold_field(k, name, i).name);
}

/* c1 1 + c2 phi^ + c3 phi phi^T, after the rotation H before the interval. */
static void code_hold_matrix(const code *w, code_value out[3][3], int after, const code_vec *phi, code_value c1,
                             code_value c2, code_value c3, const char *name)
{
  code_value own[3][3];
  code_sum s;
  char at[16];
  snprintf(at, sizeof at, "%d", after);
  for (int i = 0; i < 3; i++) {
    code_value scaled;
    code_begin(&s);
    code_add(&s, 1.0, c3, phi->x[i]);
    scaled = code_end(w, &s, code_variable("%s_s%c", name, code_axis[i]));
    for (int k = 0; k < 3; k++) {
      code_begin(&s);
      code_add_one(&s, i == k, c1);
      if (i != k) {
        code_add(&s, (k - i + 3) % 3 == 1 ? -1.0 : 1.0, c2, phi->x[3 - i - k]);
      }
      code_add(&s, 1.0, scaled, phi->x[k]);
      own[i][k] = code_end(w, &s, code_variable("%s_o%c%c", name, code_axis[i], code_axis[k]));
    }
  }
  for (int i = 0; i < 3; i++) {
    for (int k = 0; k < 3; k++) {
      code_begin(&s);
      for (int o = 0; o < 3; o++) {
        code_add(&s, 1.0, after < 0 ? code_constant(i == o) : code_at(code_line.H[i][o], at), own[o][k]);
      }
      out[i][k] = code_end(w, &s, code_variable("%s_%c%c", name, code_axis[i], code_axis[k]));
    }
  }
}

/* Velocities of node k by coordinate a, line axes, of which N takes rotation vectors to angular velocities: Jv, Jw in
   l->h_J by coordinates. */
static void code_hold_column(const code *w, int k, int a, code_value N[3][3], const code_vec *A, const code_vec *B)
{
  const fb_line_node *const at = code_hold_at(k);
  const int after = code_hold_after(k), n = code_line.n;
  code_vec turn, bow, own;
  code_sum s;
  for (int i = 0; i < 3; i++) {
    turn.x[i] = code_constant((double)at->turn[3 * a + i]);
    bow.x[i] = code_constant((double)at->bow[3 * a + i]);
  }
  for (int i = 0; i < 3; i++) {
    code_value mixed;
    code_begin(&s);
    code_add_cross(&s, 1.0, &turn, B, i);
    code_add_cross(&s, 1.0, A, &bow, i);
    mixed = code_end(w, &s, code_variable("m%d_%c", a, code_axis[i]));
    code_begin(&s);
    code_add_one(&s, 1.0, turn.x[i]);
    code_add_one(&s, -1.0 / 6.0, mixed);
    own.x[i] = code_end(w, &s, code_variable("own%d_%c", a, code_axis[i]));
  }
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, code_line_shift(a, i), code_constant(1.0));
    for (int j = 0; j < code_line.line->count; j++) {
      if (!code_is_zero(&code_line.K.x[i])) {
        code_add_one(&s, (double)at->weight[j], code_variable("l->K_%c[%d][%d]", code_axis[i], j, a));
      }
    }
    code_hold_keep(w, &s, k, "J", 6 * a + i, 6 * n);
    code_begin(&s);
    if (after >= 0 && !code_is_zero(&code_line.turn[a].x[i])) {
      code_add_one(&s, 1.0, code_variable("l->turn_%c[%d][%d]", code_axis[i], a, after));
    }
    for (int c = 0; c < 3; c++) {
      code_add(&s, 1.0, N[i][c], own.x[c]);
    }
    code_hold_keep(w, &s, k, "J", 6 * a + 3 + i, 6 * n);
  }
}

/* A, B or their rates of the interval before node k, by coordinates `by`. */
static code_vec code_hold_rows(const code *w, const char *name, const fb_real *rows, const char *by)
{
  code_vec out;
  for (int i = 0; i < 3; i++) {
    code_sum s;
    code_begin(&s);
    for (int a = 0; a < code_line.n; a++) {
      code_add_one(&s, (double)rows[3 * a + i], code_variable("%s[%d]", by, a));
    }
    out.x[i] = code_end(w, &s, code_variable("%s_%c", name, code_axis[i]));
  }
  return out;
}

/* x - (A x B)/6 */
static code_vec code_hold_bent(const code *w, const char *name, const code_vec *A, const code_vec *B)
{
  code_vec out;
  for (int i = 0; i < 3; i++) {
    code_value mixed;
    code_sum s;
    code_begin(&s);
    code_add_cross(&s, 1.0, A, B, i);
    mixed = code_end(w, &s, code_variable("%s_m%c", name, code_axis[i]));
    code_begin(&s);
    code_add_one(&s, 1.0, A->x[i]);
    code_add_one(&s, -1.0 / 6.0, mixed);
    out.x[i] = code_end(w, &s, code_variable("%s_%c", name, code_axis[i]));
  }
  return out;
}

/* E14.14 of node k: place r from O and rotation H, line axes, velocities by coordinates J; what E9.25 needs. */
static void code_hold_write(const code *w, int k)
{
  const fb_line_node *const at = code_hold_at(k);
  const int after = code_hold_after(k);
  const code_value a = code_variable("a"), b = code_variable("b");
  code_value N[3][3], H[3][3], x, sigma, tau;
  code_vec A, B, phi;
  code_sum s;
  char name[24];
  fprintf(w->out, "\n/* E14.14: node %d on it, which carries something, after its inertia. */\n", k);
  snprintf(name, sizeof name, "hold_%d", k);
  code_line_head(w, "void", name, ", const $ *q");
  A = code_hold_rows(w, "A", at->turn, "q");
  B = code_hold_rows(w, "B", at->bow, "q");
  phi = code_hold_bent(w, "phi", &A, &B);
  x = code_dot(w, "xx", &phi, &phi);
  code_begin(&s);
  code_add_one(&s, 1.0, x);
  code_declare(w, &s, "x");
  code_line_turn(w);
  x = code_variable("x");
  code_begin(&s);
  code_add_one(&s, 1.0, code_constant(1.0));
  code_add(&s, -1.0, b, x);
  sigma = code_end(w, &s, code_variable("sigma"));
  code_begin(&s);
  code_add_one(&s, 1.0, code_constant(1.0));
  code_add(&s, -1.0, a, x);
  tau = code_end(w, &s, code_variable("cosine"));
  code_hold_matrix(w, N, after, &phi, sigma, a, b, "N");
  code_hold_matrix(w, H, after, &phi, tau, sigma, a, "H");
  for (int i = 0; i < 9; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, H[i / 3][i % 3]);
    code_hold_keep(w, &s, k, "H", i, 9);
    code_begin(&s);
    code_add_one(&s, 1.0, N[i / 3][i % 3]);
    code_hold_keep(w, &s, k, "N", i, 9);
  }
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, phi.x[i]);
    code_hold_keep(w, &s, k, "phi", i, 3);
    code_begin(&s);
    code_add_one(&s, (double)at->start[i], code_constant(1.0));
    for (int j = 0; j < code_line.line->count; j++) {
      code_add_one(&s, (double)at->weight[j], code_vec_at(&code_line.t, j).x[i]);
    }
    for (int c = 0; c < code_line.n; c++) {
      code_add_one(&s, code_line_shift(c, i), code_variable("q[%d]", c));
    }
    code_hold_keep(w, &s, k, "r", i, 3);
  }
  for (int c = 0; c < code_line.n; c++) {
    code_hold_column(w, k, c, N, &A, &B);
  }
  code_member(code_variable("h%d_by[4]", k).name);
  fprintf(w->out, "  l->h%d_by[0] = a;\n  l->h%d_by[1] = b;\n  l->h%d_by[2] = e - ", k, k, k);
  code_template(w, "`0.5` * b;\n");
  fprintf(w->out, "  l->h%d_by[3] = ", k);
  code_template(w, "`1.5` * f - `0.5` * e;\n  (void)q;\n}\n");
}

/* ---- E9.25 in the sweep of E14.7: a momentum G = (P, L) about the node, held[6 at] and on */

static code_value code_hold_momentum(int at, int i)
{
  return code_variable("held[%d]", 6 * at + i);
}

/* Weights of the tangents in the places of all nodes that carry momenta. */
static void code_hold_tables(const code *w)
{
  for (int k = code_hold_next(code_carrying, 1); k >= 0; k = code_hold_next(code_carrying, k + 1)) {
    code_template(w, "  static const %s ");
    fprintf(w->out, "hold_%d[%d] = {", k, code_line.m);
    for (int j = 0; j < code_line.m; j++) {
      code_cell(w, j < code_line.line->count ? (double)code_hold_at(k)->weight[j] : 0.0, j, code_line.m);
    }
    fputs("};\n", w->out);
  }
}

/* Their linear momenta to F of point j, component i. */
static void code_hold_add(code_sum *s, int i)
{
  for (int k = code_hold_next(code_carrying, 1), n = 0; k >= 0; k = code_hold_next(code_carrying, k + 1), n++) {
    code_add(s, 1.0, code_variable("hold_%d[j]", k), code_hold_momentum(n, i));
  }
}

/* Their angular momenta to c of the points before them. */
static void code_hold_turn(const code *w)
{
  for (int k = code_hold_next(code_carrying, 1), n = 0; k >= 0; k = code_hold_next(code_carrying, k + 1), n++) {
    for (int i = 0; i < 3 && code_hold_after(k) >= 0; i++) {
      fprintf(w->out, "  l->c_%c[%d] += %s;\n", code_axis[i], code_hold_after(k), code_hold_momentum(n, 3 + i).name);
    }
  }
}

/* What L does by the interval before node k itself, added to l->g. */
static void code_hold_step(const code *w, int k, int n)
{
  const fb_line_node *const at = code_hold_at(k);
  const int after = code_hold_after(k);
  code_vec A, B, A_dot, B_dot, phi, rate, L, back, before, own, y, by, pc, rc, ppc, mixed, other;
  code_value a_dot, b_dot, x_dot;
  char place[16];
  code_sum s;
  snprintf(place, sizeof place, "%d", after);
  A = code_hold_rows(w, "A", at->turn, "q");
  B = code_hold_rows(w, "B", at->bow, "q");
  A_dot = code_hold_rows(w, "A_dot", at->turn, "q_dot");
  B_dot = code_hold_rows(w, "B_dot", at->bow, "q_dot");
  for (int i = 0; i < 3; i++) {
    code_value part;
    code_begin(&s);
    code_add_cross(&s, 1.0, &A_dot, &B, i);
    code_add_cross(&s, 1.0, &A, &B_dot, i);
    part = code_end(w, &s, code_variable("both_%c", code_axis[i]));
    code_begin(&s);
    code_add_one(&s, 1.0, A_dot.x[i]);
    code_add_one(&s, -1.0 / 6.0, part);
    rate.x[i] = code_end(w, &s, code_variable("rate_%c", code_axis[i]));
    phi.x[i] = code_hold_field(k, "phi", i);
    L.x[i] = code_hold_momentum(n, 3 + i);
    before.x[i] = after < 0 ? code_variable("o_%c", code_axis[i]) : code_at(code_line.w.x[i], place);
  }
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    for (int o = 0; o < 3; o++) {
      code_add(&s, 1.0, after < 0 ? code_constant(i == o) : code_at(code_line.H[o][i], place), L.x[o]);
    }
    back.x[i] = code_end(w, &s, code_variable("back_%c", code_axis[i]));
  }
  x_dot = code_dot(w, "x_dot", &phi, &rate);
  code_begin(&s);
  code_add(&s, 2.0, x_dot, code_hold_field(k, "by", 2));
  a_dot = code_end(w, &s, code_variable("a_dot"));
  code_begin(&s);
  code_add(&s, 2.0, x_dot, code_hold_field(k, "by", 3));
  b_dot = code_end(w, &s, code_variable("b_dot"));

  /* y = (dT/dt)^T back + N^T (L x w before), by = N^T L */
  pc = code_cross(w, "pc", &phi, &back);
  rc = code_cross(w, "rc", &rate, &back);
  ppc = code_cross(w, "ppc", &phi, &pc);
  own = code_cross(w, "Lw", &L, &before);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_cross(&s, 1.0, &phi, &rc, i);
    code_add_cross(&s, 1.0, &rate, &pc, i);
    mixed.x[i] = code_end(w, &s, code_variable("mix_%c", code_axis[i]));
  }
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add(&s, -1.0, a_dot, pc.x[i]);
    code_add(&s, -1.0, code_hold_field(k, "by", 0), rc.x[i]);
    code_add(&s, 1.0, b_dot, ppc.x[i]);
    code_add(&s, 1.0, code_hold_field(k, "by", 1), mixed.x[i]);
    for (int o = 0; o < 3; o++) {
      code_add(&s, 1.0, code_hold_field(k, "N", 3 * o + i), own.x[o]);
    }
    y.x[i] = code_end(w, &s, code_variable("y_%c", code_axis[i]));
    code_begin(&s);
    for (int o = 0; o < 3; o++) {
      code_add(&s, 1.0, code_hold_field(k, "N", 3 * o + i), L.x[o]);
    }
    by.x[i] = code_end(w, &s, code_variable("by_%c", code_axis[i]));
  }

  /* to the coordinates */
  for (int i = 0; i < 3; i++) {
    code_value part;
    code_begin(&s);
    code_add_cross(&s, 1.0, &B, &y, i);
    code_add_cross(&s, 1.0, &B_dot, &by, i);
    part = code_end(w, &s, code_variable("By_%c", code_axis[i]));
    code_begin(&s);
    code_add_one(&s, 1.0, y.x[i]);
    code_add_one(&s, -1.0 / 6.0, part);
    own.x[i] = code_end(w, &s, code_variable("to_A_%c", code_axis[i]));
    code_begin(&s);
    code_add_cross(&s, 1.0, &y, &A, i);
    code_add_cross(&s, 1.0, &by, &A_dot, i);
    other.x[i] = code_end(w, &s, code_variable("to_B_%c", code_axis[i]));
  }
  for (int a = 0; a < code_line.n; a++) {
    code_begin(&s);
    code_add_one(&s, 1.0, code_variable("l->g[%d]", a));
    for (int i = 0; i < 3; i++) {
      code_add_one(&s, (double)at->turn[3 * a + i], own.x[i]);
      code_add_one(&s, -(double)at->bow[3 * a + i] / 6.0, other.x[i]);
    }
    code_assign(w, &s, code_variable("l->g[%d]", a).name);
  }
}

/* Of all nodes. */
static void code_hold_steps(const code *w)
{
  code inner = *w;
  inner.indent = 4;
  fputs(code_line.carries ? "  (void)q, (void)q_dot;\n" : "", w->out);
  for (int k = code_hold_next(code_carrying, 1), n = 0; k >= 0; k = code_hold_next(code_carrying, k + 1), n++) {
    fprintf(w->out, "  { /* E9.25: by the interval before node %d itself */\n", k);
    code_hold_step(&inner, k, n);
    fputs("  }\n", w->out);
  }
}
#endif
