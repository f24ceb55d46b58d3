/* code_line.h - writes the geometrically exact lines of a body (THEORY.md 14) for code.h: of each line its poses, its
   inertia, its velocities and the gradient of its kinetic energy as functions of their own, with loops over the points
   whose number is constant and tables in place of sums over rows. What is zero by structure is left out. */
#ifndef CODE_LINE_H
#define CODE_LINE_H
#include "code_model.h"
#include "code_text.h"

typedef struct code_vec {
  code_value x[3];
} code_vec;

enum { CODE_MEMBERS = 200, CODE_TABLES = 9 };

/* The line that is written. */
static struct code_line {
  const fb_lines *all;
  const fb_line *line;
  int number, n, width, m;            /* coordinates, these rounded up to even; points */
  int row[CODE_TABLES][FB_MAX_MODES]; /* of A, B, Gamma by axes: 1 + the row of the table `turn` of each coordinate */
  int by[CODE_TABLES];                /* 1: some coordinate has it */
  int n_row;
  int centered;                               /* 1: E14.17 about the mass center of the whole, see code_line_center */
  double whole, kept;                         /* |sqrt(m)|; kappa */
  double Q[FB_MAX_POINTS][FB_MAX_POINTS + 4]; /* C, then Q^T sqrt(m), then start of E14.17 as they are written */
  int plane, offset, spread; /* turns about one axis alone; mass centers beside the line; rotary inertia */
  int n_member;
  char member[CODE_MEMBERS][CODE_NAME];
  code_vec A, B, phi, t, phi_dot, A_dot, B_dot, w, tau, Y; /* at point j */
  code_value H[3][3], N[3][3], I[3][3];
  code_vec K, turn[FB_MAX_MODES]; /* E14.5 of coordinate a at point j */
  int carries;                    /* nodes that carry momenta (code_hold.h) */
} code_line;

/* Lines of the body that is written, the number of its first one in names; 1: it is one of a tree. */
static struct code_line code_own_lines[FB_MAX_LINES], *code_lines = code_own_lines;
static int code_lines_first, code_lines_carried;

static const char code_axis[3] = {'x', 'y', 'z'};

/* ---- what a line has */

static double code_line_coefficient(int kind, int row, int j)
{
  const fb_line_row *const r = &code_line.all->row[code_line.line->row + row];
  return (double)code_line.all->table[r->at + (kind == 1 ? code_line.m : 0) + j];
}

/* 1 if kind k (A, B, Gamma) of a row is not zero at some point */
static int code_line_row_is_used(int kind, int row)
{
  for (int j = 0; j < code_line.m; j++) {
    if (fabs(code_line_coefficient(kind, row, j)) > 0.0) {
      return 1;
    }
  }
  return 0;
}

static void code_line_begin(int k)
{
  const fb_lines *const all = &code_model.body->lines;
  const fb_line *const line = &all->line[k];
  memset(&code_line, 0, sizeof code_line);
  code_line.all = all;
  code_line.line = line;
  code_line.number = code_lines_first + k;
  code_line.n = line->n;
  code_line.width = (line->n + 1) / 2 * 2;
  code_line.m = line->stride;
  for (int r = 0; r < line->n_turn + line->n_stretch; r++) {
    const fb_line_row *const row = &all->row[line->row + r];
    for (int kind = r < line->n_turn ? 0 : 2; kind < (r < line->n_turn ? 2 : 3); kind++) {
      if (code_line_row_is_used(kind, r)) {
        code_line.row[3 * kind + row->axis][row->a] = 1 + r;
        code_line.by[3 * kind + row->axis] = 1;
      }
    }
  }
  if (code_line.by[0] + code_line.by[1] + code_line.by[2] == 1) { /* turns about one axis commute: B is of no effect */
    memset(code_line.row + 3, 0, 3 * sizeof code_line.row[0]);
    memset(code_line.by + 3, 0, 3 * sizeof code_line.by[0]);
  }
  for (int j = line->point; j < line->point + line->count && line->solid; j++) {
    for (int i = 0; i < 3; i++) {
      code_line.offset |= fabs((double)all->center[3 * j + i]) > 0.0;
    }
    for (int i = 0; i < 6; i++) {
      code_line.spread |= fabs((double)all->inertia[6 * j + i]) > 0.0;
    }
  }
}

/* What point j's tangent adds to the position of point s; C, Q^T sqrt(m) and the start of E14.17. */
static double code_line_W(int s, int j)
{
  return (double)code_line.all->table[code_line.line->weight + j * code_line.m + s];
}

static double code_line_C(int s, int j)
{
  return (double)fbi_line_factor(code_line.all, code_line.line)[j * code_line.m + s];
}

static double code_line_u(int s)
{
  return (double)fbi_line_factor(code_line.all, code_line.line)[code_line.line->count * code_line.m + s];
}

static double code_line_start(int i, int s)
{
  return (double)fbi_line_factor(code_line.all, code_line.line)[(code_line.line->count + 1 + i) * code_line.m + s];
}

static double code_line_mass(int s)
{
  return (double)code_line.all->mass[code_line.line->point + s];
}

/* What the rest of the body has of the linear momentum of coordinate a, line axes; constant where the line is centered. */
static double code_line_rest(int a, int i)
{
  const fb_line *const line = code_line.line;
  double sum = 0.0;
  for (int k = 0; k < 3; k++) {
    sum += (line->turned ? (double)line->axes[3 * k + i] : i == k ? 1.0 : 0.0) * code_model.lambda[k].constant[a];
  }
  return sum;
}

/* 1 if the linear momentum of the rest does not depend on q */
static int code_line_rest_is_constant(void)
{
  int constant = 1;
  for (int k = 0; k < 3; k++) {
    for (int a = 0; a < code_model.n; a++) {
      for (int b = 0; b < code_model.n; b++) {
        constant = constant && !(fabs(code_model.lambda[k].slope[a][b]) > 0.0);
      }
    }
  }
  return constant;
}

/* x -= 2 v (v.x) by columns of Q: the reflection that leaves nothing of a column below `row`. */
static void code_line_reflect(int row, int column, int n_column)
{
  const int count = code_line.line->count;
  double v[FB_MAX_POINTS] = {0.0}, size = 0.0, norm = 0.0;
  for (int s = row; s < count; s++) {
    v[s] = code_line.Q[s][column];
    size += v[s] * v[s];
  }
  v[row] += v[row] < 0.0 ? -sqrt(size) : sqrt(size);
  for (int s = row; s < count; s++) {
    norm += v[s] * v[s];
  }
  for (int c = 0; c < n_column && norm > 0.0; c++) {
    double dot = 0.0;
    for (int s = row; s < count; s++) {
      dot += v[s] * code_line.Q[s][c];
    }
    for (int s = row; s < count; s++) {
      code_line.Q[s][c] -= 2.0 * dot / norm * v[s];
    }
  }
}

/* What is written of E14.17. Of a free body with this line alone Q^T sqrt(m) = (|sqrt(m)|, 0, ..), and row 0 becomes kappa
   times itself less |sqrt(m)|/(m kappa) times what the rest has, kappa = sqrt(1 - m_line/m): P_rest of Y, c_rest of y. Then
   sums over Y and y are those relative to the mass center of the whole, M - P^T P/m, L - c x P/m and the second moments
   of mass without c c^T/m, but for what the rest of mass m_rest has itself, P_rest^T P_rest/m_rest and so on. */
static void code_line_center(void)
{
  const fb_body *const body = code_model.body;
  const fb_line *const line = code_line.line;
  const int count = line->count;
  double mass = 0.0;
  for (int s = 0; s < count; s++) {
    for (int k = 0; k < count; k++) {
      code_line.Q[s][k] = code_line_C(s, k);
    }
    code_line.Q[s][count] = code_line_u(s);
    for (int i = 0; i < 3; i++) {
      code_line.Q[s][count + 1 + i] = code_line_start(i, s);
    }
    mass += code_line_u(s) * code_line_u(s);
  }
  code_line.whole = sqrt(mass);
  code_line.kept = 1.0 - mass / (double)body->mass;
  code_line.centered = !code_lines_carried && body->base == FB_BASE_FREE && body->lines.n_line == 1 &&
                       line->n == body->n && count > 1 && !code_line.offset && code_line.kept > 1e-3 &&
                       code_line_rest_is_constant();
  if (!code_line.centered) {
    return;
  }
  code_line.kept = sqrt(code_line.kept);
  code_line_reflect(0, count, count + 4);
  for (int s = 1; s + 1 < count; s++) {
    code_line_reflect(s, s - 1, count + 4);
  }
  if (code_line.Q[0][count] < 0.0) {
    for (int c = 0; c < count + 4; c++) {
      code_line.Q[0][c] = -code_line.Q[0][c];
    }
  }
  for (int s = 1; s < count; s++) { /* what is round-off */
    code_line.Q[s][count] = 0.0;
    for (int k = 0; k + 1 < s; k++) {
      code_line.Q[s][k] = 0.0;
    }
  }
  for (int s = 0; s < count; s++) {
    for (int k = 0; k < count; k++) {
      code_line.Q[s][k] = fabs(code_line.Q[s][k]) < 1e-15 * code_line.whole ? 0.0 : code_line.Q[s][k];
    }
  }
  for (int c = 0; c < count + 4; c++) {
    code_line.Q[0][c] *= code_line.kept;
  }
}

/* |sqrt(m)|/(m kappa) */
static double code_line_share(void)
{
  return code_line.whole / ((double)code_model.body->mass * code_line.kept);
}

/* Sum of m W W^T, of the masses outboard of a tangent, of their places. */
static double code_line_outboard(int j, int k)
{
  double sum = 0.0;
  for (int s = 0; s < code_line.line->count; s++) {
    sum += code_line_C(s, j) * (k < 0 ? code_line_u(s) : code_line_C(s, k));
  }
  return sum;
}

static double code_line_outboard_start(int i, int j)
{
  double sum = 0.0;
  for (int s = 0; s < code_line.line->count; s++) {
    sum += code_line_C(s, j) * code_line_start(i, s);
  }
  return sum;
}

/* First moment of mass of the straight root, i < 0: mass. */
static double code_line_moment(int i)
{
  double sum = 0.0;
  for (int s = 0; s < code_line.line->count; s++) {
    sum += code_line_u(s) * (i < 0 ? code_line_u(s) : code_line_start(i, s));
  }
  return sum;
}

static double code_line_shift(int a, int i)
{
  return code_line.line->moves ? (double)code_line.all->table[code_line.line->shift + 3 * a + i] : 0.0;
}

/* ---- text */

static void code_loop(const code *w, int indent, char index, int first, int end)
{
  fprintf(w->out, "%*sfor (int %c = %d; %c < %d; %c++) {\n", indent, "", index, first, index, end, index);
}

/* A loop from point to point, each from the one before: unrolled. */
static void code_scan(const code *w, int m)
{
  code_template(w, "  @_UNROLL\n");
  code_loop(w, 2, 'j', 1, m);
}

/* Declares a field of the line: "name[m]" and so on. */
static void code_member(const char *name)
{
  for (int k = 0; k < code_line.n_member; k++) {
    if (strcmp(code_line.member[k], name) == 0) {
      return;
    }
  }
  if (code_line.n_member == CODE_MEMBERS) {
    fputs("reduce: --code: a line of too many fields\n", stderr);
    exit(1);
  }
  strcpy(code_line.member[code_line.n_member++], name);
}

/* The sum to the field `name` at [j], what it is then called; constants need no field. */
static code_value code_keep(const code *w, code_sum *s, const char *name)
{
  code_value field = code_variable("%s", name);
  char target[CODE_NAME + 8];
  code_settle(s);
  if (s->n == 0) {
    return code_constant(s->constant);
  }
  snprintf(target, sizeof target, "%s[%d]", name, code_line.m);
  code_member(target);
  snprintf(target, sizeof target, "l->%s[j]", name);
  code_assign(w, s, target);
  field = code_variable("l->%s[j]", name);
  return field;
}

static code_value code_keep_one(const code *w, code_value x, const char *name)
{
  code_sum s;
  code_begin(&s);
  code_add_one(&s, 1.0, x);
  return code_keep(w, &s, name);
}

static code_vec code_keep_vec(const code *w, const code_vec *x, const char *name)
{
  code_vec y;
  for (int i = 0; i < 3; i++) {
    y.x[i] = code_keep_one(w, x->x[i], code_variable("%s_%c", name, code_axis[i]).name);
  }
  return y;
}

/* What a field that code_keep made is called elsewhere: at point `at`, by a pointer to the line or by its name. */
static code_value code_at(code_value x, const char *at)
{
  const int bare = (int)strcspn(x.name, "[");
  code_value y = x;
  if (x.name[bare]) {
    y = code_plain("%.*s[%s]", bare, x.name, at);
    y.c = x.c;
  }
  return y;
}

static code_vec code_vec_at(const code_vec *x, int j)
{
  char at[16];
  code_vec y;
  snprintf(at, sizeof at, "%d", j);
  for (int i = 0; i < 3; i++) {
    y.x[i] = code_at(x->x[i], at);
  }
  return y;
}

/* s += c (a x b)_i */
static void code_add_cross(code_sum *s, double c, const code_vec *a, const code_vec *b, int i)
{
  const int y = (i + 1) % 3, z = (i + 2) % 3;
  code_add(s, c, a->x[y], b->x[z]);
  code_add(s, -c, a->x[z], b->x[y]);
}

static code_vec code_cross(const code *w, const char *name, const code_vec *a, const code_vec *b)
{
  code_vec out;
  for (int i = 0; i < 3; i++) {
    code_sum s;
    code_begin(&s);
    code_add_cross(&s, 1.0, a, b, i);
    out.x[i] = code_end(w, &s, code_variable("%s_%c", name, code_axis[i]));
  }
  return out;
}

static code_value code_dot(const code *w, const char *name, const code_vec *a, const code_vec *b)
{
  code_sum s;
  code_begin(&s);
  for (int i = 0; i < 3; i++) {
    code_add(&s, 1.0, a->x[i], b->x[i]);
  }
  return code_end(w, &s, code_variable("%s", name));
}

static code_vec code_scale(const code *w, const char *name, double c, code_value x, const code_vec *a)
{
  code_vec out;
  for (int i = 0; i < 3; i++) {
    code_sum s;
    code_begin(&s);
    code_add(&s, c, x, a->x[i]);
    out.x[i] = code_end(w, &s, code_variable("%s_%c", name, code_axis[i]));
  }
  return out;
}

static code_vec code_vec_named(const char *format)
{
  code_vec v;
  for (int i = 0; i < 3; i++) {
    v.x[i] = code_variable("%s_%c", format, code_axis[i]);
  }
  return v;
}

/* A number of a table. */
static void code_cell(const code *w, double x, int at, int in_row)
{
  char number[40];
  code_number(number, w, fabs(x) > 0.0 ? x : 0.0);
  fprintf(w->out, "%s%s", at == 0 ? "" : at % 5 == 0 && in_row > 5 ? ",\n     " : ", ", number);
}

/* The line's tables: A, B, Gamma by rows and points for sums over the coordinates; by points, kinds and coordinates. */
static void code_line_tables(const code *w)
{
  int n_row = 0;
  for (int t = 0; t < CODE_TABLES; t++) {
    for (int a = 0; a < code_line.n; a++) {
      n_row += code_line.row[t][a] > 0;
    }
  }
  code_template(w, "\n/* Line ");
  fprintf(w->out, "%d: A, B and Gamma (E14.1, E14.4) of its coordinates, those that are not zero, by points */\n",
          code_line.number);
  code_template(w, "static const %s @_turn_");
  fprintf(w->out, "%d[%d][%d] = {", code_line.number, n_row, code_line.m);
  for (int t = 0; t < CODE_TABLES; t++) {
    for (int a = 0; a < code_line.n; a++) {
      const int row = code_line.row[t][a] - 1;
      if (row >= 0) {
        fprintf(w->out, "%s\n    {", code_line.n_row ? "," : "");
        for (int j = 0; j < code_line.m; j++) {
          code_cell(w, code_line_coefficient(t / 3, row, j), j, code_line.m);
        }
        fputs("}", w->out);
        code_line.row[t][a] = ++code_line.n_row; /* from here on 1 + its place in the table */
      }
    }
  }
  fputs("};\n", w->out);
}

/* Opens a function of the line. */
static void code_line_head(const code *w, const char *type, const char *name, const char *arguments)
{
  code_template(w, "static @_NOINLINE ");
  fprintf(w->out, "%s ", type);
  code_template(w, "@_");
  fprintf(w->out, "%s_%d(", name, code_line.number);
  code_template(w, "@_line_");
  fprintf(w->out, "%d *", code_line.number);
  code_template(w, "@_RESTRICT l");
  code_template(w, arguments);
  fputs(")\n{\n", w->out);
}

/* A local name of a table. */
static void code_line_alias(const code *w)
{
  fprintf(w->out, "  const %s (*const T)[%d] = ", code_scalar(w), code_line.m);
  code_template(w, "@_turn_");
  fprintf(w->out, "%d;\n", code_line.number);
}

static void code_line_coordinates(const code *w, const char *name)
{
  for (int a = 0; a < code_line.n; a++) {
    code_template(w, "  const $ ");
    fprintf(w->out, "%s_%d = %s[%d];\n", name, a, name, a);
  }
}

/* Vector of kind 0, 1, 2 (A, B, Gamma) times coordinates `by` at point j. */
static code_vec code_line_rows(const code *w, int kind, const char *name, const char *by)
{
  code_vec out;
  for (int i = 0; i < 3; i++) {
    code_sum s;
    code_begin(&s);
    for (int a = 0; a < code_line.n; a++) {
      if (code_line.row[3 * kind + i][a]) {
        code_add(&s, 1.0, code_variable("T[%d][j]", code_line.row[3 * kind + i][a] - 1), code_variable("%s_%d", by, a));
      }
    }
    out.x[i] = code_end(w, &s, code_variable("%s_%c", name, code_axis[i]));
  }
  return out;
}

/* name = 1/first! - x/(first + 2)! + .. */
static void code_line_series(const code *w, const char *name, int first)
{
  const int terms = w->single ? 5 : 8;
  double c = 1.0;
  char number[40];
  for (int k = 2; k <= first; k++) {
    c /= k;
  }
  code_template(w, "    const $ ");
  fprintf(w->out, "%s = ", name);
  for (int k = 0; k < terms; k++) {
    code_number(number, w, c);
    fprintf(w->out, "%s%s", number, k + 1 < terms ? " + x * (" : "");
    if (k % 3 == 2) {
      fputs("\n      ", w->out);
    }
    c /= -(double)((first + 2 * k + 1) * (first + 2 * k + 2));
  }
  for (int k = 1; k < terms; k++) {
    fputs(")", w->out);
  }
  fputs(";\n", w->out);
}

/* a = 1/2 - x e and b = 1/6 - x f of E14.2, of x = |phi|^2. */
static void code_line_turn(const code *w)
{
  char number[40];
  code_line_series(w, "e", 4);
  code_line_series(w, "f", 5);
  code_number(number, w, 1.0 / 6.0);
  code_template(w, "    const $ a = `0.5` - x * e;\n    const $ b = ");
  fprintf(w->out, "%s - x * f;\n", number);
}

/* ---- E14.1 to E14.4: poses */

static void code_line_turns(const code *w)
{
  code_sum s;
  code_vec mixed;
  code_value x;
  int turns = 0;
  code code_in = *w;
  const code *const in = &code_in;
  code_in.indent = 4;
  fputs("\n  /* E14.1: rotation vectors phi of the intervals before the points */\n", w->out);
  code_loop(w, 2, 'j', 0, code_line.m);
  code_line.A = code_line_rows(in, 0, "A", "q");
  code_line.B = code_line_rows(in, 1, "B", "q");
  mixed = code_cross(in, "m", &code_line.A, &code_line.B);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, code_line.A.x[i]);
    code_add_one(&s, -1.0 / 6.0, mixed.x[i]);
    code_line.phi.x[i] = code_end(in, &s, code_variable("phi_%c", code_axis[i]));
    turns += !code_is_zero(&code_line.phi.x[i]);
  }
  code_line.plane = turns <= 1;
  x = code_dot(in, "x", &code_line.phi, &code_line.phi);
  code_line.phi = code_keep_vec(in, &code_line.phi, "phi");
  if (!code_line.plane) {
    code_line.A = code_keep_vec(in, &code_line.A, "A");
    code_line.B = code_keep_vec(in, &code_line.B, "B");
  }
  code_keep_one(in, x, "x");
  fputs("  }\n", w->out);
}

static void code_line_half(const code *w)
{
  code inner = *w;
  code_vec d;
  inner.indent = 4;
  fputs("\n  /* E14.2: a = (1 - cos)/x, b = (|phi| - sin)/|phi|^3 of x = |phi|^2, their derivatives; half angles, as "
        "quaternions */\n",
        w->out);
  code_loop(w, 2, 'j', 0, code_line.m);
  code_template(w, "    const $ x = l->x[j];\n");
  code_line_turn(w);
  code_template(w, "    l->quat_w[j] = `0.5` - `0.5` * b * x;\n"
                   "    l->half[j] = `1` - `0.5` * a * x;\n");
  code_member(code_variable("half[%d]", code_line.m).name);
  if (!code_line.plane) {
    code_keep_one(&inner, code_variable("a"), "a");
    code_keep_one(&inner, code_variable("b"), "b");
    code_template(w, "    l->a1[j] = e - `0.5` * b;\n    l->b1[j] = `1.5` * f - `0.5` * e;\n");
    code_member(code_variable("a1[%d]", code_line.m).name);
    code_member(code_variable("b1[%d]", code_line.m).name);
  }
  code_member(code_variable("quat_w[%d]", code_line.m).name);
  fputs("  }\n", w->out);
  code_loop(w, 2, 'j', 0, code_line.m);
  code_template(w, "    l->half[j] = sqrt~(l->half[j]);\n  }\n");
  code_loop(w, 2, 'j', 0, code_line.m);
  code_template(w, "    const $ half = l->half[j], share = l->quat_w[j] / half;\n    l->quat_w[j] = half;\n");
  d = code_scale(&inner, "d", 1.0, code_variable("share"), &code_line.phi);
  code_keep_vec(&inner, &d, "quat");
  for (int i = 0; i < 3 && !code_line.plane; i++) {
    if (code_is_zero(&d.x[i])) { /* turns that commute, of this alone the quaternion's product */
      fprintf(w->out, "    l->quat_%c[j] = ", code_axis[i]);
      code_template(w, w->lanes ? "%z;\n" : "0;\n");
      code_member(code_variable("quat_%c[%d]", code_axis[i], code_line.m).name);
    }
  }
  fputs("  }\n", w->out);
}

/* now = p o d, called name_w, name_x, .. */
static void code_quat_product(const code *w, code_value now[4], const code_value p[4], const code_value d[4],
                              const char *name)
{
  static const int other[4][4] = {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}};
  static const int sign[4][4] = {{1, -1, -1, -1}, {1, 1, 1, -1}, {1, -1, 1, 1}, {1, 1, -1, 1}};
  for (int i = 0; i < 4; i++) {
    code_sum s;
    code_begin(&s);
    for (int k = 0; k < 4; k++) {
      code_add(&s, sign[i][k], p[k], d[other[i][k]]);
    }
    now[i] = code_end(w, &s, code_variable("%s_%c", name, "wxyz"[i]));
  }
}

static void code_line_quats(const code *w)
{
  code inner = *w;
  code_value p[4], d[4], now[4];
  inner.indent = 4;
  for (int i = 0; i < 4; i++) {
    const char name = "wxyz"[i];
    const int none = i > 0 && code_is_zero(&code_line.phi.x[i - 1]) && code_line.plane;
    p[i] = none ? code_constant(0.0) : code_variable("p_%c", name);
    d[i] = none ? code_constant(0.0) : code_variable("l->quat_%c[j]", name);
  }
  fputs("\n  /* E14.3: quaternions of the points, each from the one before */\n", w->out);
  code_scan(w, code_line.m);
  for (int i = 0; i < 4; i++) {
    if (!code_is_zero(&p[i])) {
      code_template(w, "    const $ ");
      fprintf(w->out, "%s = l->quat_%c[j - 1];\n", p[i].name, "wxyz"[i]);
    }
  }
  code_quat_product(&inner, now, p, d, "n");
  for (int i = 0; i < 4; i++) {
    if (!code_is_zero(&now[i])) {
      fprintf(w->out, "    l->quat_%c[j] = %s;\n", "wxyz"[i], now[i].name);
    }
  }
  fputs("  }\n", w->out);
}

/* One element of H of a quaternion in names. */
static void code_line_matrix(const code *w, code_value H[3][3], const code_value q[4], const char *name)
{
  code_value two[4];
  code_sum s;
  for (int i = 1; i < 4; i++) {
    code_begin(&s);
    code_add_one(&s, 2.0, q[i]);
    two[i] = code_end(w, &s, code_variable("two_%c", "wxyz"[i]));
  }
  for (int i = 0; i < 3; i++) {
    for (int k = 0; k < 3; k++) {
      const int y = 1 + (i + 1) % 3, z = 1 + (i + 2) % 3;
      code_begin(&s);
      if (i == k) {
        code_add_one(&s, 1.0, code_constant(1.0));
        code_add(&s, -1.0, two[y], q[y]);
        code_add(&s, -1.0, two[z], q[z]);
      } else {
        code_add(&s, 1.0, two[1 + i], q[1 + k]);
        code_add(&s, (k - i + 3) % 3 == 1 ? -1.0 : 1.0, two[1 + 3 - i - k], q[0]);
      }
      H[i][k] = code_end(w, &s, code_variable("%s_%c%c", name, code_axis[i], code_axis[k]));
    }
  }
}

static void code_line_tangents(const code *w)
{
  code inner = *w;
  code_value q[4], e[3];
  code_vec stretch;
  char name[CODE_NAME];
  code_sum s;
  inner.indent = 4;
  fputs("\n  /* E14.4: their matrices H, tangents t = H (e + Gamma q) */\n", w->out);
  code_loop(w, 2, 'j', 0, code_line.m);
  for (int i = 0; i < 4; i++) {
    q[i] = i > 0 && code_is_zero(&code_line.phi.x[i - 1]) && code_line.plane
               ? code_constant(0.0)
               : code_variable("l->quat_%c[j]", "wxyz"[i]);
  }
  code_line_matrix(&inner, code_line.H, q, "H");
  stretch = code_line_rows(&inner, 2, "stretch", "q");
  for (int i = 0; i < 3; i++) {
    int same = 1;
    const fb_real *const tangent = code_line.all->tangent[i] + code_line.line->point;
    for (int j = 1; j < code_line.line->count; j++) {
      same = same && !(fabs((double)(tangent[j] - tangent[0])) > 0.0);
    }
    e[i] = same ? code_constant((double)tangent[0]) : code_variable("tangent[%d][j]", i);
    code_begin(&s);
    code_add_one(&s, 1.0, e[i]);
    code_add_one(&s, 1.0, stretch.x[i]);
    e[i] = code_end(&inner, &s, code_variable("e_%c", code_axis[i]));
  }
  for (int i = 0; i < 3; i++) {
    for (int k = 0; k < 3; k++) {
      snprintf(name, sizeof name, "H_%c%c", code_axis[i], code_axis[k]);
      code_line.H[i][k] = code_keep_one(&inner, code_line.H[i][k], name);
    }
  }
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    for (int k = 0; k < 3; k++) {
      code_add(&s, 1.0, code_line.H[i][k], e[k]);
    }
    code_settle(&s);
    snprintf(name, sizeof name, "t_%c", code_axis[i]);
    code_line.t.x[i] = s.n == 1 && s.term[0].y[0] == '\0' && !(fabs(s.term[0].c - 1.0) > 0.0)
                           ? code_variable("%s", s.term[0].x)
                           : code_keep(&inner, &s, name);
  }
  fputs("  }\n", w->out);
}

static void code_line_pose(const code *w, int unused)
{
  int curved = 0;
  (void)unused;
  fprintf(w->out, "\n/* Line %d at the coordinates q: 0 where an interval turns too far. */\n", code_line.number);
  code_line_head(w, "int", "pose", ", const $ *q");
  for (int i = 0; i < 3; i++) {
    for (int j = 1; j < code_line.line->count; j++) {
      const fb_real *const tangent = code_line.all->tangent[i] + code_line.line->point;
      curved = curved || fabs((double)(tangent[j] - tangent[0])) > 0.0;
    }
  }
  if (curved) {
    code_template(w, "  static const %s tangent[3][");
    fprintf(w->out, "%d] = {", code_line.m);
    for (int i = 0; i < 3; i++) {
      fputs(i ? ",\n    {" : "\n    {", w->out);
      for (int j = 0; j < code_line.m; j++) {
        code_cell(w, (double)code_line.all->tangent[i][code_line.line->point + j], j, code_line.m);
      }
      fputs("}", w->out);
    }
    fputs("};\n", w->out);
  }
  code_line_alias(w);
  code_template(w, "  $ most = %z;\n");
  code_line_coordinates(w, "q");
  code_line_turns(w);
  code_line_half(w);
  code_line_quats(w);
  code_line_tangents(w);
  code_template(w,
                "\n  /* E14.2: range of the series; what is no number is found where M is factored */\n  @_UNROLL\n");
  code_loop(w, 2, 'j', 0, code_line.m);
  code_template(w, w->lanes
                       ? "    most = @_either(l->x[j] > most, l->x[j], most);\n  }\n  return %(most <= `1.5`%);\n}\n"
                       : "    most = l->x[j] > most ? l->x[j] : most;\n  }\n  return most <= `1.5`;\n}\n");
}

/* ---- E14.5, E14.6: inertia */

static void code_line_maps(const code *w)
{
  code inner = *w;
  code_vec b;
  char name[CODE_NAME];
  inner.indent = 4;
  for (int k = 0; k < 3; k++) { /* plane: about its axis T is 1 */
    for (int i = 0; i < 3; i++) {
      code_line.N[i][k] =
          code_line.plane && !code_is_zero(&code_line.phi.x[k]) ? code_line.H[i][k] : code_constant(0.0);
    }
  }
  if (code_line.plane) {
    return;
  }
  fputs("\n  /* E14.3: N = H T, T = 1 - a phi^ + b phi^2: angular velocity of an interval by phi_dot */\n", w->out);
  code_loop(w, 2, 'j', 0, code_line.m);
  b = code_scale(&inner, "b", 1.0, code_variable("l->b[j]"), &code_line.phi);
  {
    code_vec a = code_scale(&inner, "a", 1.0, code_variable("l->a[j]"), &code_line.phi);
    for (int k = 0; k < 3; k++) {
      code_value T[3];
      code_sum s;
      for (int i = 0; i < 3; i++) {
        const int y = (i + 1) % 3, z = (i + 2) % 3;
        code_begin(&s);
        if (i == k) {
          code_add_one(&s, 1.0, code_constant(1.0));
          code_add(&s, -1.0, b.x[y], code_line.phi.x[y]);
          code_add(&s, -1.0, b.x[z], code_line.phi.x[z]);
        } else {
          code_add(&s, 1.0, b.x[i], code_line.phi.x[k]);
          code_add_one(&s, (k - i + 3) % 3 == 1 ? 1.0 : -1.0, a.x[3 - i - k]);
        }
        T[i] = code_end(&inner, &s, code_variable("T_%c%c", code_axis[i], code_axis[k]));
      }
      for (int i = 0; i < 3; i++) {
        code_begin(&s);
        for (int o = 0; o < 3; o++) {
          code_add(&s, 1.0, code_line.H[i][o], T[o]);
        }
        snprintf(name, sizeof name, "N_%c%c", code_axis[i], code_axis[k]);
        code_line.N[i][k] = code_keep(&inner, &s, name);
      }
    }
  }
  fputs("  }\n", w->out);
}

/* Mass centers rho and rotary inertia I of the points. */
static code_vec code_line_rho;

static void code_line_solid(const code *w)
{
  code inner = *w;
  int used[9] = {0};
  const fb_line *const line = code_line.line;
  code_sum s;
  inner.indent = 4;
  code_line_rho.x[0] = code_line_rho.x[1] = code_line_rho.x[2] = code_constant(0.0);
  for (int i = 0; i < 9; i++) {
    code_line.I[i / 3][i % 3] = code_constant(0.0);
  }
  if (!code_line.offset && !code_line.spread) {
    return;
  }
  fputs("\n  /* E14.6: mass centers of the points from the line, rotary inertia about them, line axes */\n", w->out);
  code_template(w, "  static const %s own[9][");
  fprintf(w->out, "%d] = {", code_line.m);
  for (int i = 0; i < 9; i++) {
    fputs(i ? ",\n    {" : "\n    {", w->out);
    for (int j = 0; j < code_line.m; j++) {
      const int at = line->point + j;
      const double c = j >= line->count ? 0.0
                       : i < 3          ? (double)code_line.all->center[3 * at + i]
                                        : (double)code_line.all->inertia[6 * at + i - 3];
      used[i] |= fabs(c) > 0.0;
      code_cell(w, c, j, code_line.m);
    }
    fputs("}", w->out);
  }
  fputs("};\n", w->out);
  code_loop(w, 2, 'j', 0, code_line.m);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    for (int k = 0; k < 3; k++) {
      code_add(&s, used[k], code_line.H[i][k], code_variable("own[%d][j]", k));
    }
    code_line_rho.x[i] = code_keep(&inner, &s, code_variable("rho_%c", code_axis[i]).name);
  }
  {
    static const int packed[3][3] = {{3, 4, 5}, {4, 6, 7}, {5, 7, 8}};
    code_value HI[3][3];
    for (int i = 0; i < 3; i++) {
      for (int k = 0; k < 3; k++) {
        code_begin(&s);
        for (int o = 0; o < 3; o++) {
          code_add(&s, used[packed[o][k]], code_line.H[i][o], code_variable("own[%d][j]", packed[o][k]));
        }
        HI[i][k] = code_end(&inner, &s, code_variable("HI_%c%c", code_axis[i], code_axis[k]));
      }
    }
    for (int i = 0; i < 3; i++) {
      for (int k = i; k < 3; k++) {
        code_begin(&s);
        for (int o = 0; o < 3; o++) {
          code_add(&s, 1.0, HI[i][o], code_line.H[k][o]);
        }
        code_line.I[i][k] = code_line.I[k][i] =
            code_keep(&inner, &s, code_variable("I_%c%c", code_axis[i], code_axis[k]).name);
      }
    }
  }
  fputs("  }\n", w->out);
}

/* Columns of what A and B of a coordinate about axis k add: N (1 + B^/6) and -N A^/6. */
static void code_line_columns(const code *w, code_value EA[3][3], code_value EB[3][3])
{
  code inner = *w;
  code_vec u, v;
  code_sum s;
  inner.indent = 4;
  memcpy(EA, code_line.N, sizeof code_line.N);
  for (int i = 0; i < 9; i++) {
    EB[i / 3][i % 3] = code_constant(0.0);
  }
  if (code_line.plane) {
    return;
  }
  u = code_scale(&inner, "u", 1.0 / 6.0, code_constant(1.0), &code_line.A);
  v = code_scale(&inner, "v", 1.0 / 6.0, code_constant(1.0), &code_line.B);
  for (int k = 0; k < 3; k++) {
    const int y = (k + 1) % 3, z = (k + 2) % 3;
    for (int i = 0; i < 3; i++) {
      if (code_line.by[k]) {
        code_begin(&s);
        code_add_one(&s, 1.0, code_line.N[i][k]);
        code_add(&s, 1.0, code_line.N[i][y], v.x[z]);
        code_add(&s, -1.0, code_line.N[i][z], v.x[y]);
        EA[i][k] = code_end(&inner, &s, code_variable("EA_%c%c", code_axis[i], code_axis[k]));
      }
      if (code_line.by[3 + k]) {
        code_begin(&s);
        code_add(&s, -1.0, code_line.N[i][y], u.x[z]);
        code_add(&s, 1.0, code_line.N[i][z], u.x[y]);
        EB[i][k] = code_end(&inner, &s, code_variable("EB_%c%c", code_axis[i], code_axis[k]));
      }
    }
  }
}

/* A field by points and coordinates, at coordinate a; no: what is zero of every coordinate so far. */
static void code_keep_by(const code *w, code_sum *s, code_value *field, const char *name, int a)
{
  char target[CODE_NAME + 16];
  code_settle(s);
  if (s->n == 0) {
    return;
  }
  code_member(code_variable("%s[%d][%d]", name, code_line.m, code_line.width).name);
  snprintf(target, sizeof target, "l->%s[j][%d]", name, a);
  code_assign(w, s, target);
  *field = code_variable("l->%s[j][a]", name);
}

static code_vec code_line_K, code_line_Jw, code_line_h;
static int code_line_known[9][FB_MAX_MODES]; /* 1: the field is set of coordinate a */

/* Angular velocities of the points by coordinate a, before their sum. */
static code_vec code_line_steps(const code *w, int a, code_value EA[3][3], code_value EB[3][3])
{
  code_vec turn;
  code_sum s;
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    for (int k = 0; k < 3; k++) {
      if (code_line.row[k][a]) {
        code_add(&s, 1.0, EA[i][k], code_variable("T[%d][j]", code_line.row[k][a] - 1));
      }
      if (code_line.row[3 + k][a]) {
        code_add(&s, 1.0, EB[i][k], code_variable("T[%d][j]", code_line.row[3 + k][a] - 1));
      }
    }
    turn.x[i] = code_constant(0.0);
    if (s.n > 0) {
      turn.x[i] = code_variable("l->turn_%c[%d][j]", code_axis[i], a);
      code_member(code_variable("turn_%c[%d][%d]", code_axis[i], code_line.n, code_line.m).name);
      code_assign(w, &s, turn.x[i].name);
    }
  }
  return turn;
}

/* E14.5 of coordinate a, from its angular velocities. */
static void code_line_jacobian(const code *w, int a, const code_vec *turn)
{
  code_sum s;
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_cross(&s, 1.0, turn, &code_line.t, i);
    for (int k = 0; k < 3; k++) {
      if (code_line.row[6 + k][a]) {
        code_add(&s, 1.0, code_line.H[i][k], code_variable("T[%d][j]", code_line.row[6 + k][a] - 1));
      }
    }
    code_keep_by(w, &s, &code_line_K.x[i], code_variable("K_%c", code_axis[i]).name, a);
    code_line_known[i][a] = s.n > 0;
  }
  for (int i = 0; i < 3 && (code_line.offset || code_line.spread); i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, turn->x[i]);
    code_keep_by(w, &s, &code_line_Jw.x[i], code_variable("W_%c", code_axis[i]).name, a);
    code_line_known[3 + i][a] = s.n > 0;
  }
  for (int i = 0; i < 3 && code_line.spread; i++) {
    code_begin(&s);
    for (int k = 0; k < 3; k++) {
      code_add(&s, 1.0, code_line.I[i][k], turn->x[k]);
    }
    code_keep_by(w, &s, &code_line_h.x[i], code_variable("h_%c", code_axis[i]).name, a);
    code_line_known[6 + i][a] = s.n > 0;
  }
}

/* What is zero of some coordinates alone, the spare one among them. */
static void code_line_blanks(const code *w)
{
  static const char *const name[3] = {"K", "W", "h"};
  const code_vec *const field[3] = {&code_line_K, &code_line_Jw, &code_line_h};
  for (int f = 0; f < 9; f++) {
    for (int a = 0; a < code_line.width && !code_is_zero(&field[f / 3]->x[f % 3]); a++) {
      if (!code_line_known[f][a]) {
        code_loop(w, 2, 'j', 0, code_line.m);
        fprintf(w->out, "    l->%s_%c[j][%d] = ", name[f / 3], code_axis[f % 3], a);
        code_template(w, w->lanes ? "%z;\n  }\n" : "0;\n  }\n");
      }
    }
  }
}

static void code_line_jacobians(const code *w)
{
  static code_vec turn[FB_MAX_MODES];
  code_value EA[3][3], EB[3][3];
  code inner = *w;
  inner.indent = 4;
  memset(code_line_known, 0, sizeof code_line_known);
  for (int i = 0; i < 3; i++) {
    code_line_K.x[i] = code_line_Jw.x[i] = code_line_h.x[i] = code_constant(0.0);
  }
  fputs("\n  /* E14.5: by coordinates the angular velocity of each point, a sum from the root of N (1 + B^/6) A_a - N "
        "A^/6 "
        "B_a, and\n     K, the rate of its tangent */\n",
        w->out);
  code_loop(w, 2, 'j', 0, code_line.m);
  code_line_columns(w, EA, EB);
  for (int a = 0; a < code_line.n; a++) {
    turn[a] = code_line_steps(&inner, a, EA, EB);
  }
  fputs("  }\n", w->out);
  for (int a = 0; a < code_line.n; a++) {
    code_scan(w, code_line.m);
    for (int i = 0; i < 3; i++) {
      if (!code_is_zero(&turn[a].x[i])) {
        fprintf(w->out, "    l->turn_%c[%d][j] += l->turn_%c[%d][j - 1];\n", code_axis[i], a, code_axis[i], a);
      }
    }
    fputs("  }\n", w->out);
  }
  code_loop(w, 2, 'j', 0, code_line.m);
  for (int a = 0; a < code_line.n; a++) {
    code_line_jacobian(&inner, a, &turn[a]);
  }
  fputs("  }\n", w->out);
  code_line.K = code_line_K;
  memcpy(code_line.turn, turn, sizeof turn);
  code_line_blanks(w);
}

/* Names of fields by coordinates at point j: [j][a] or with the name of another index. */
static code_value code_by_at(code_value x, int j, const char *index)
{
  char at[CODE_NAME];
  snprintf(at, sizeof at, "%d][%s", j, index);
  return code_at(x, at);
}

/* E14.17: Y = Q^T sqrt(m) Jv of the mass centers by points. */
static void code_line_weigh(const code *w)
{
  code inner = *w;
  const int count = code_line.line->count;
  inner.indent = 4;
  fputs("\n  /* E14.17: Y = C K, velocities of the mass centers by coordinates, weighed */\n", w->out);
  for (int i = 0; i < 3; i++) {
    code_line.Y.x[i] = code_variable("l->Y_%c[j][a]", code_axis[i]);
    if (code_is_zero(&code_line_K.x[i]) && !code_line.line->moves && !code_line.offset && !code_line.centered) {
      code_line.Y.x[i] = code_constant(0.0);
    } else {
      code_member(code_variable("Y_%c[%d][%d]", code_axis[i], count, code_line.width).name);
    }
  }
  if (code_line.centered) {
    code_template(w, "  static const %s rest[3][");
    fprintf(w->out, "%d] = {", code_line.width);
    for (int i = 0; i < 3; i++) {
      fputs(i ? ",\n    {" : "\n    {", w->out);
      for (int a = 0; a < code_line.width; a++) {
        code_cell(w, a < code_line.n ? -code_line_share() * code_line_rest(a, i) : 0.0, a, code_line.width);
      }
      fputs("}", w->out);
    }
    fputs("}; /* of the rest of the body, for row 0 about the mass center of the whole */\n", w->out);
  }
  if (code_line.line->moves) {
    code_template(w, "  static const %s shift[3][");
    fprintf(w->out, "%d] = {", code_line.width);
    for (int i = 0; i < 3; i++) {
      fputs(i ? ", {" : "{", w->out);
      for (int a = 0; a < code_line.width; a++) {
        code_cell(w, a < code_line.n ? code_line_shift(a, i) : 0.0, a, code_line.width);
      }
      fputs("}", w->out);
    }
    fputs("}; /* of the root by coordinates */\n", w->out);
  }
  code_loop(w, 2, 'a', 0, code_line.width);
  for (int j = 0; j < count; j++) {
    code_vec turn, rho;
    for (int i = 0; i < 3; i++) {
      turn.x[i] = code_by_at(code_line_Jw.x[i], j, "a");
    }
    rho = code_vec_at(&code_line_rho, j);
    for (int i = 0; i < 3; i++) {
      code_sum s;
      code_begin(&s);
      for (int k = 0; k < count; k++) {
        code_add_one(&s, code_line.Q[j][k], code_by_at(code_line_K.x[i], k, "a"));
      }
      if (code_line.line->moves) {
        code_add_one(&s, code_line.Q[j][count], code_variable("shift[%d][a]", i));
      }
      if (code_line.centered && j == 0) {
        code_add_one(&s, 1.0, code_variable("rest[%d][a]", i));
      }
      if (code_line.offset) {
        code_sum more;
        code_value own;
        code_begin(&more);
        code_add_cross(&more, 1.0, &turn, &rho, i);
        own = code_end(&inner, &more, code_variable("more_%c_%d", code_axis[i], j));
        code_add_one(&s, code_line.Q[j][count], own);
      }
      if (!code_is_zero(&code_line.Y.x[i])) {
        code_assign(&inner, &s, code_by_at(code_line.Y.x[i], j, "a").name);
      }
    }
  }
  fputs("  }\n", w->out);
}

static code_value code_line_y[3][FB_MAX_POINTS];

/* Centers of mass as E14.17 has them, moments of mass. */
static void code_line_centers(const code *w)
{
  static const int pair[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
  const int count = code_line.line->count;
  code_value yy[6];
  code_sum s;
  fputs("\n  /* the same of their places; mass, first and second moments of mass about O, line axes */\n", w->out);
  for (int j = 0; j < count; j++) {
    const code_vec rho = code_vec_at(&code_line_rho, j);
    for (int i = 0; i < 3; i++) {
      code_begin(&s);
      code_add_one(&s, code_line.Q[j][count + 1 + i], code_constant(1.0));
      for (int k = 0; k < count; k++) {
        char at[16];
        snprintf(at, sizeof at, "%d", k);
        code_add_one(&s, code_line.Q[j][k], code_at(code_line.t.x[i], at));
      }
      code_add_one(&s, code_line.Q[j][count], rho.x[i]);
      if (code_line.centered && j == 0) {
        code_add_one(&s, -code_line_share(), code_variable("hub[%d]", i));
      }
      if (code_line.line->moves) {
        code_add_one(&s, code_line.Q[j][count], code_variable("root_%c", code_axis[i]));
      }
      code_line_y[i][j] = code_end(w, &s, code_variable("y_%c_%d", code_axis[i], j));
    }
  }
  for (int i = 0; i < 3; i++) {
    const double share = code_line.whole / code_line.kept;
    code_begin(&s);
    for (int j = 0; j < count && !code_line.centered; j++) {
      code_add_one(&s, code_line.Q[j][count], code_line_y[i][j]);
    }
    if (code_line.centered) {
      code_add_one(&s, share * code_line_share(), code_variable("hub[%d]", i));
      code_add_one(&s, share, code_line_y[i][0]);
    }
    code_assign(w, &s, code_variable("l->c[%d]", i).name);
  }
  for (int e = 0; e < 6; e++) {
    code_begin(&s);
    for (int j = 0; j < count; j++) {
      code_add(&s, 1.0, code_line_y[pair[e][0]][j], code_line_y[pair[e][1]][j]);
    }
    yy[e] = code_end(w, &s, code_variable("yy_%c%c", code_axis[pair[e][0]], code_axis[pair[e][1]]));
  }
  for (int e = 0; e < 6; e++) {
    const int i = pair[e][0], k = pair[e][1];
    code_begin(&s);
    if (i == k) {
      code_add_one(&s, 1.0, yy[i == 0 ? 3 : 0]);
      code_add_one(&s, 1.0, yy[i == 2 ? 3 : 5]);
    } else {
      code_add_one(&s, -1.0, yy[e]);
    }
    for (int j = 0; j < count && code_line.spread; j++) {
      char at[16];
      snprintf(at, sizeof at, "%d", j);
      code_add_one(&s, 1.0, code_at(code_line.I[i][k], at));
    }
    code_assign(w, &s, code_variable("l->J[%d]", e).name);
  }
  code_member("c[4]");
  code_member("J[6]");
}

static void code_line_products(const code *w)
{
  code inner = *w;
  const int count = code_line.line->count;
  code_sum s;
  inner.indent = 4;
  fputs("\n  /* E14.6: elastic mass M (upper triangle), P and L, linear and angular momentum about O by coordinates "
        "*/\n",
        w->out);
  for (int a = 0; a < code_line.n; a++) {
    char own[16];
    snprintf(own, sizeof own, "%d", a);
    code_loop(w, 2, 'b', a / 2 * 2, code_line.width);
    code_begin(&s);
    for (int j = 0; j < count; j++) {
      for (int i = 0; i < 3; i++) {
        code_add(&s, 1.0, code_by_at(code_line.Y.x[i], j, own), code_by_at(code_line.Y.x[i], j, "b"));
        code_add(&s, 1.0, code_by_at(code_line_h.x[i], j, own), code_by_at(code_line_Jw.x[i], j, "b"));
      }
    }
    code_assign(&inner, &s, code_variable("l->M[%d][b]", a).name);
    fputs("  }\n", w->out);
  }
  code_loop(w, 2, 'a', 0, code_line.width);
  for (int i = 0; i < 3 && !code_line.centered; i++) {
    code_begin(&s);
    for (int j = 0; j < count; j++) {
      code_add_one(&s, code_line.Q[j][count], code_by_at(code_line.Y.x[i], j, "a"));
    }
    code_assign(&inner, &s, code_variable("l->P[%d][a]", i).name);
  }
  for (int i = 0; i < 3; i++) {
    const int y = (i + 1) % 3, z = (i + 2) % 3;
    code_begin(&s);
    for (int j = 0; j < count; j++) {
      code_add(&s, 1.0, code_line_y[y][j], code_by_at(code_line.Y.x[z], j, "a"));
      code_add(&s, -1.0, code_line_y[z][j], code_by_at(code_line.Y.x[y], j, "a"));
      code_add_one(&s, 1.0, code_by_at(code_line_h.x[i], j, "a"));
    }
    code_assign(&inner, &s, code_variable("l->L[%d][a]", i).name);
  }
  fputs("  }\n", w->out);
  code_member(code_variable("M[%d][%d]", code_line.n, code_line.width).name);
  if (!code_line.centered) {
    code_member(code_variable("P[3][%d]", code_line.width).name);
  }
  code_member(code_variable("L[3][%d]", code_line.width).name);
}

/* Displacement of a root that moves with the coordinates, from those or their rates: name_x, name_y, name_z. */
static code_vec code_line_root(const code *w, const char *name, const char *by)
{
  code_vec root;
  for (int i = 0; i < 3; i++) {
    code_sum s;
    code_begin(&s);
    for (int a = 0; a < code_line.n; a++) {
      code_add_one(&s, code_line_shift(a, i), code_variable("%s[%d]", by, a));
    }
    code_settle(&s);
    if (code_line.line->moves) {
      char target[48];
      snprintf(target, sizeof target, "%s_%c", name, code_axis[i]);
      code_declare(w, &s, target);
    }
    root.x[i] = code_line.line->moves ? code_variable("%s_%c", name, code_axis[i]) : code_constant(0.0);
  }
  return root;
}

static void code_line_inertia(const code *w, int unused)
{
  (void)unused;
  fputs(code_line.centered ? "\n/* Its inertia relative to the mass center of the whole, after its pose; hub: first "
                             "moment of mass of the "
                             "rest,\n   line axes. */\n"
                           : "\n/* Its inertia, after its pose. */\n",
        w->out);
  code_line_head(w, "void", "inertia",
                 code_line.centered && code_line.line->moves ? ", const $ *hub, const $ *q"
                 : code_line.centered                        ? ", const $ *hub"
                 : code_line.line->moves                     ? ", const $ *q"
                                                             : "");
  code_line_alias(w);
  code_line_root(w, "root", "q");
  code_line_maps(w);
  code_line_solid(w);
  code_line_jacobians(w);
  code_line_weigh(w);
  code_line_centers(w);
  code_line_products(w);
  fputs("}\n", w->out);
}

/* ---- velocities */

static void code_line_drift(const code *w, int unused)
{
  code inner = *w;
  code_vec step, glide, cross;
  code_sum s;
  (void)unused;
  inner.indent = 4;
  fputs("\n/* Its angular velocities w and the rates of its tangents, tau, at rates of the coordinates and the angular "
        "velocity o\n   of the frame, after its inertia. */\n",
        w->out);
  code_line_head(w, "void", "drift", ", const $ *q_dot, const $ *o");
  code_line_alias(w);
  code_line_coordinates(w, "q_dot");
  code_loop(w, 2, 'j', 0, code_line.m);
  code_line.A_dot = code_line_rows(&inner, 0, "A_dot", "q_dot");
  if (code_line.plane) {
    code_line.phi_dot = code_line.A_dot;
  } else {
    code_line.B_dot = code_line_rows(&inner, 1, "B_dot", "q_dot");
    for (int i = 0; i < 3; i++) {
      code_value mixed;
      code_begin(&s);
      code_add_cross(&s, 1.0, &code_line.A_dot, &code_line.B, i);
      code_add_cross(&s, 1.0, &code_line.A, &code_line.B_dot, i);
      mixed = code_end(&inner, &s, code_variable("mixed_%c", code_axis[i]));
      code_begin(&s);
      code_add_one(&s, 1.0, code_line.A_dot.x[i]);
      code_add_one(&s, -1.0 / 6.0, mixed);
      code_line.phi_dot.x[i] = code_end(&inner, &s, code_variable("rate_%c", code_axis[i]));
    }
    code_line.A_dot = code_keep_vec(&inner, &code_line.A_dot, "A_dot");
    code_line.B_dot = code_keep_vec(&inner, &code_line.B_dot, "B_dot");
  }
  code_line.phi_dot = code_keep_vec(&inner, &code_line.phi_dot, "rate");
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    for (int k = 0; k < 3; k++) {
      code_add(&s, 1.0, code_line.N[i][k], code_line.phi_dot.x[k]);
    }
    step.x[i] = code_keep(&inner, &s, code_variable("w_%c", code_axis[i]).name);
  }
  fputs("  }\n", w->out);
  for (int i = 0; i < 3; i++) {
    code_line.w.x[i] = code_is_zero(&step.x[i]) ? code_variable("o_%c", code_axis[i]) : step.x[i];
    code_template(w, "  const $ ");
    fprintf(w->out, "o_%c = o[%d];\n", code_axis[i], i);
    if (!code_is_zero(&step.x[i])) {
      fprintf(w->out, "  l->w_%c[0] += o_%c;\n", code_axis[i], code_axis[i]);
    }
  }
  code_scan(w, code_line.m);
  for (int i = 0; i < 3; i++) {
    if (!code_is_zero(&step.x[i])) {
      fprintf(w->out, "    l->w_%c[j] += l->w_%c[j - 1];\n", code_axis[i], code_axis[i]);
    }
  }
  fputs("  }\n", w->out);
  code_loop(w, 2, 'j', 0, code_line.m);
  glide = code_line_rows(&inner, 2, "glide", "q_dot");
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_cross(&s, 1.0, &code_line.w, &code_line.t, i);
    for (int k = 0; k < 3; k++) {
      code_add(&s, 1.0, code_line.H[i][k], glide.x[k]);
    }
    cross.x[i] = code_keep(&inner, &s, code_variable("tau_%c", code_axis[i]).name);
  }
  code_line.tau = cross;
  fputs("  }\n}\n", w->out);
}

#include "code_hold.h"

/* ---- E14.7: gradient of the kinetic energy */

static code_vec code_line_F, code_line_b, code_line_c;

/* Table of the masses outboard: of point k by points, the name G. */
static void code_line_masses(const code *w, const char *name, int kind)
{
  const int count = code_line.line->count;
  code_template(w, "  static const %s ");
  fprintf(w->out, "%s[%d][%d] = {", name, count + (kind < 2 ? 4 : 0), code_line.m);
  for (int l = 0; l < count + (kind < 2 ? 4 : 0); l++) {
    fputs(l ? ",\n    {" : "\n    {", w->out);
    for (int j = 0; j < code_line.m; j++) {
      double c = 0.0;
      if (j < count) {
        if (kind == 0) { /* outboard momentum directly */
          c = l < count    ? code_line_outboard(j, l)
              : l == count ? code_line_outboard(j, -1)
                           : code_line_outboard_start(l - count - 1, j);
        } else if (kind == 1) { /* momenta of the points */
          c = code_line_mass(j) * (l < count ? code_line_W(j, l)
                                   : l == count
                                       ? 1.0
                                       : (double)code_line.all->start[l - count - 1][code_line.line->point + j]);
        } else { /* felt at the tangents */
          c = code_line_W(l, j);
        }
      }
      code_cell(w, c, j, code_line.m);
    }
    fputs("}", w->out);
  }
  fputs("};\n", w->out);
}

static int code_line_starts(int kind, int i)
{
  for (int j = 0; j < code_line.line->count; j++) {
    const double c = kind == 0 ? code_line_outboard_start(i, j)
                               : (double)code_line.all->start[i][code_line.line->point + j] * code_line_mass(j);
    if (fabs(c) > 1e-300) {
      return 1;
    }
  }
  return 0;
}

/* Momentum from table G: sum of G_l tau_l + G_m U + o x G_start, component i to the sum. */
static void code_line_momentum(code_sum *s, int kind, const code_vec *o, int i)
{
  const int count = code_line.line->count;
  code_vec start;
  code_begin(s);
  for (int l = 0; l < count; l++) {
    char at[16];
    snprintf(at, sizeof at, "%d", l);
    code_add(s, 1.0, code_variable("G[%d][j]", l), code_at(code_line.tau.x[i], at));
  }
  code_add(s, 1.0, code_variable("G[%d][j]", count), code_variable("U_%c", code_axis[i]));
  for (int k = 0; k < 3; k++) {
    start.x[k] = code_line_starts(kind, k) ? code_variable("G[%d][j]", count + 1 + k) : code_constant(0.0);
  }
  code_add_cross(s, 1.0, o, &start, i);
}

static void code_line_outboard_forces(const code *w, const code_vec *o)
{
  code inner = *w;
  code_sum s;
  code_vec P = {{{0.0, ""}, {0.0, ""}, {0.0, ""}}}, move = P;
  inner.indent = 4;
  code_hold_tables(w);
  code_line_masses(w, "G", code_line.offset ? 1 : 0);
  if (code_line.offset) {
    code_line_masses(w, "W", 2);
    fputs("\n  /* momenta P of the points, at their mass centers r + rho */\n", w->out);
    code_loop(w, 2, 'j', 0, code_line.m);
    move = code_cross(&inner, "move", &code_line.w, &code_line_rho);
    for (int i = 0; i < 3; i++) {
      code_line_momentum(&s, 1, o, i);
      code_add(&s, 1.0, code_variable("G[%d][j]", code_line.line->count), move.x[i]);
      P.x[i] = code_keep(&inner, &s, code_variable("p_%c", code_axis[i]).name);
    }
    code_keep_vec(&inner, &move, "move");
    fputs("  }\n", w->out);
    move = code_vec_named("l->move");
    for (int i = 0; i < 3; i++) {
      move.x[i] = code_variable("l->move_%c[j]", code_axis[i]);
    }
  }
  fputs(
      "\n  /* F, momenta outboard; by a virtual rotation c = t x F, by its rate; b = tau x F; solid points add rho x P "
      "+ I w and\n     (w x rho) x P */\n",
      w->out);
  code_loop(w, 2, 'j', 0, code_line.m);
  for (int i = 0; i < 3; i++) {
    if (code_line.offset) {
      code_begin(&s);
      for (int l = 0; l < code_line.line->count; l++) {
        char at[16];
        snprintf(at, sizeof at, "%d", l);
        code_add(&s, 1.0, code_variable("W[%d][j]", l), code_at(P.x[i], at));
      }
    } else {
      code_line_momentum(&s, 0, o, i);
    }
    code_hold_add(&s, i);
    code_line_F.x[i] = code_end(&inner, &s, code_variable("F_%c", code_axis[i]));
  }
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_cross(&s, 1.0, &code_line.t, &code_line_F, i);
    code_add_cross(&s, 1.0, &code_line_rho, &P, i);
    for (int k = 0; k < 3 && code_line.spread; k++) {
      code_add(&s, 1.0, code_line.I[i][k], code_line.w.x[k]);
    }
    code_line_c.x[i] = code_keep(&inner, &s, code_variable("c_%c", code_axis[i]).name);
    code_begin(&s);
    code_add_cross(&s, 1.0, &code_line.tau, &code_line_F, i);
    code_add_cross(&s, 1.0, &move, &P, i);
    code_line_b.x[i] = code_keep(&inner, &s, code_variable("b_%c", code_axis[i]).name);
  }
  if (code_line.by[6] || code_line.by[7] || code_line.by[8]) {
    code_line_F = code_keep_vec(&inner, &code_line_F, "F");
  }
  fputs("  }\n", w->out);
  code_hold_turn(w);
  fputs("\n  /* from the tip to the root */\n", w->out);
  code_template(w, "  @_UNROLL\n");
  fprintf(w->out, "  for (int j = %d; j >= 0; j--) {\n", code_line.m - 2);
  for (int i = 0; i < 3; i++) {
    fprintf(w->out, "    l->b_%c[j] += l->b_%c[j + 1];\n    l->c_%c[j] += l->c_%c[j + 1];\n", code_axis[i],
            code_axis[i], code_axis[i], code_axis[i]);
  }
  fputs("  }\n", w->out);
}

/* E14.7: y by phi, s by phi_dot; by[]: what acts by A, B, Gamma. */
static void code_line_moments(const code *w, code_value by[CODE_TABLES])
{
  code inner = *w;
  code_vec X, y, s_dot, gamma;
  code_sum s;
  inner.indent = 4;
  fputs("\n  /* to the rotation vectors: y by phi, s by phi_dot; then by A, B and Gamma */\n", w->out);
  code_loop(w, 2, 'j', 0, code_line.m);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, code_line_b.x[i]);
    code_add_cross(&s, 1.0, &code_line_c, &code_line.w, i);
    X.x[i] = code_end(&inner, &s, code_variable("X_%c", code_axis[i]));
  }
  for (int k = 0; k < 3; k++) {
    code_begin(&s);
    for (int i = 0; i < 3; i++) {
      code_add(&s, 1.0, code_line.N[i][k], X.x[i]);
    }
    y.x[k] = code_end(&inner, &s, code_variable("Y_%c", code_axis[k]));
    code_begin(&s);
    for (int i = 0; i < 3; i++) {
      code_add(&s, 1.0, code_line.H[i][k], code_line_c.x[i]);
    }
    gamma.x[k] = code_end(&inner, &s, code_variable("gamma_%c", code_axis[k]));
  }
  if (!code_line.plane) {
    const code_vec *const phi = &code_line.phi, *const rate = &code_line.phi_dot;
    const code_value pg = code_dot(&inner, "pg", phi, &gamma), rg = code_dot(&inner, "rg", rate, &gamma),
                     pr = code_dot(&inner, "pr", phi, rate);
    code_vec g, ga;
    code_value b_pg, to_phi, to_gamma, a_dot, b_dot, sigma;
    code_begin(&s);
    code_add(&s, 2.0, pr, code_variable("l->a1[j]"));
    a_dot = code_end(&inner, &s, code_variable("a_dot"));
    code_begin(&s);
    code_add(&s, 2.0, pr, code_variable("l->b1[j]"));
    b_dot = code_end(&inner, &s, code_variable("b_dot"));
    code_begin(&s);
    code_add(&s, 1.0, pg, code_variable("l->b[j]"));
    b_pg = code_end(&inner, &s, code_variable("b_pg"));
    code_begin(&s);
    code_add(&s, 1.0, b_dot, pg);
    code_add(&s, 1.0, rg, code_variable("l->b[j]"));
    to_phi = code_end(&inner, &s, code_variable("to_phi"));
    code_begin(&s);
    code_add(&s, 1.0, b_dot, code_variable("l->x[j]"));
    code_add(&s, 2.0, pr, code_variable("l->b[j]"));
    to_gamma = code_end(&inner, &s, code_variable("to_gamma"));
    code_begin(&s);
    code_add_one(&s, 1.0, code_constant(1.0));
    code_add(&s, -1.0, code_variable("l->b[j]"), code_variable("l->x[j]"));
    sigma = code_end(&inner, &s, code_variable("sigma"));
    ga = code_scale(&inner, "ga", 1.0, code_variable("l->a[j]"), phi);
    for (int i = 0; i < 3; i++) {
      code_begin(&s);
      code_add(&s, 1.0, a_dot, phi->x[i]);
      code_add(&s, 1.0, rate->x[i], code_variable("l->a[j]"));
      g.x[i] = code_end(&inner, &s, code_variable("g_%c", code_axis[i]));
    }
    for (int i = 0; i < 3; i++) {
      code_begin(&s);
      code_add_one(&s, 1.0, y.x[i]);
      code_add_cross(&s, 1.0, &g, &gamma, i);
      code_add(&s, 1.0, to_phi, phi->x[i]);
      code_add(&s, 1.0, b_pg, rate->x[i]);
      code_add(&s, -1.0, to_gamma, gamma.x[i]);
      y.x[i] = code_end(&inner, &s, code_variable("y_%c", code_axis[i]));
      code_begin(&s);
      code_add(&s, 1.0, sigma, gamma.x[i]);
      code_add_cross(&s, 1.0, &ga, &gamma, i);
      code_add(&s, 1.0, b_pg, phi->x[i]);
      s_dot.x[i] = code_end(&inner, &s, code_variable("s_%c", code_axis[i]));
    }
  }
  for (int i = 0; i < 3; i++) {
    code_value mixed;
    char name[CODE_NAME];
    snprintf(name, sizeof name, "by_A_%c", code_axis[i]);
    if (code_line.by[i]) {
      code_begin(&s);
      if (!code_line.plane) {
        code_add_cross(&s, 1.0, &code_line.B, &y, i);
        code_add_cross(&s, 1.0, &code_line.B_dot, &s_dot, i);
      }
      mixed = code_end(&inner, &s, code_variable("B_y_%c", code_axis[i]));
      code_begin(&s);
      code_add_one(&s, 1.0, y.x[i]);
      code_add_one(&s, -1.0 / 6.0, mixed);
      by[i] = code_keep(&inner, &s, name);
    }
    if (code_line.by[3 + i] && !code_line.plane) {
      code_begin(&s);
      code_add_cross(&s, 1.0, &code_line.A, &y, i);
      code_add_cross(&s, 1.0, &code_line.A_dot, &s_dot, i);
      mixed = code_end(&inner, &s, code_variable("A_y_%c", code_axis[i]));
      code_begin(&s);
      code_add_one(&s, 1.0 / 6.0, mixed);
      snprintf(name, sizeof name, "by_B_%c", code_axis[i]);
      by[3 + i] = code_keep(&inner, &s, name);
    }
  }
  if (code_line.by[6] || code_line.by[7] || code_line.by[8]) { /* H^T (F x w) */
    const code_vec Q = code_cross(&inner, "Q", &code_line_F, &code_line.w);
    for (int k = 0; k < 3; k++) {
      if (code_line.by[6 + k]) {
        code_begin(&s);
        for (int i = 0; i < 3; i++) {
          code_add(&s, 1.0, code_line.H[i][k], Q.x[i]);
        }
        by[6 + k] = code_keep(&inner, &s, code_variable("by_G_%c", code_axis[k]).name);
      }
    }
  }
  fputs("  }\n", w->out);
}

/* Forces on a root that moves: the whole momentum times o. */
static void code_line_root_force(const code *w, const code_vec *o)
{
  code_vec P, Q;
  code_sum s;
  for (int i = 0; i < 3; i++) {
    code_vec start;
    code_begin(&s);
    for (int j = 0; j < code_line.line->count; j++) {
      char at[16];
      snprintf(at, sizeof at, "%d", j);
      if (code_line.offset) {
        code_add_one(&s, 1.0, code_variable("l->p_%c[%d]", code_axis[i], j));
      } else {
        code_add_one(&s, code_line_outboard(j, -1), code_at(code_line.tau.x[i], at));
      }
    }
    if (!code_line.offset) {
      code_add_one(&s, code_line_moment(-1), code_variable("U_%c", code_axis[i]));
      for (int k = 0; k < 3; k++) {
        start.x[k] = code_constant(code_line_moment(k));
      }
      code_add_cross(&s, 1.0, o, &start, i);
    }
    for (int n = 0; n < code_line.carries; n++) {
      code_add_one(&s, 1.0, code_hold_momentum(n, i));
    }
    P.x[i] = code_end(w, &s, code_variable("whole_%c", code_axis[i]));
  }
  Q = code_cross(w, "pull", &P, o);
  for (int a = 0; a < code_line.n; a++) {
    code_begin(&s);
    code_add_one(&s, 1.0, code_variable("l->g[%d]", a));
    for (int i = 0; i < 3; i++) {
      code_add_one(&s, code_line_shift(a, i), Q.x[i]);
    }
    code_assign(w, &s, code_variable("l->g[%d]", a).name);
  }
}

static void code_line_gradient(const code *w, int unused)
{
  code_vec o, root, move, cross;
  code_value by[CODE_TABLES];
  code_sum s;
  (void)unused;
  fputs("\n/* E14.7: g, the gradient of its kinetic energy at fixed velocities u, o of the frame, line axes, and rates "
        "of "
        "the\n   coordinates, by one sweep from the tip, after its drift. */\n",
        w->out);
  code_line_head(w, "void", "gradient",
                 code_line.carries       ? ", const $ *u, const $ *o, const $ *q, const $ *q_dot, const $ *held"
                 : code_line.line->moves ? ", const $ *u, const $ *o, const $ *q, const $ *q_dot"
                                         : ", const $ *u, const $ *o");
  code_line_alias(w);
  for (int i = 0; i < 3; i++) {
    o.x[i] = code_variable("o_%c", code_axis[i]);
    code_template(w, "  const $ ");
    fprintf(w->out, "o_%c = o[%d];\n", code_axis[i], i);
  }
  root = code_line_root(w, "root", "q");
  move = code_line_root(w, "shift", "q_dot");
  cross = code_cross(w, "carry", &o, &root);
  for (int i = 0; i < 3; i++) {
    char target[32];
    code_begin(&s);
    code_add_one(&s, 1.0, code_variable("u[%d]", i));
    code_add_one(&s, 1.0, move.x[i]);
    code_add_one(&s, 1.0, cross.x[i]);
    snprintf(target, sizeof target, "U_%c", code_axis[i]);
    code_declare(w, &s, target);
  }
  code_line_outboard_forces(w, &o);
  for (int t = 0; t < CODE_TABLES; t++) {
    by[t] = code_constant(0.0);
  }
  code_line_moments(w, by);
  fputs("\n  /* to the coordinates */\n", w->out);
  code_member(code_variable("g[%d]", code_line.width).name);
  for (int a = 0; a < code_line.n; a++) {
    code_begin(&s);
    for (int t = 0; t < CODE_TABLES; t++) {
      for (int j = 0; j < code_line.line->count && code_line.row[t][a]; j++) {
        char at[16];
        snprintf(at, sizeof at, "%d", j);
        code_add(&s, 1.0, code_variable("T[%d][%d]", code_line.row[t][a] - 1, j), code_at(by[t], at));
      }
    }
    code_assign(w, &s, code_variable("l->g[%d]", a).name);
  }
  if (code_line.line->moves) {
    code_line_root_force(w, &o);
  }
  code_hold_steps(w);
  fputs("}\n", w->out);
}

/* ---- all lines */

/* Fields of the line. */
static void code_line_type(const code *w)
{
  fputs("\n/* What an evaluation knows about line ", w->out);
  fprintf(w->out, "%d, line axes, by points (j) and coordinates (a) */\ntypedef struct ", code_line.number);
  code_template(w, "@_line_");
  fprintf(w->out, "%d {\n", code_line.number);
  for (int k = 0; k < code_line.n_member; k++) {
    code_template(w, "  $ ");
    fprintf(w->out, "%s;\n", code_line.member[k]);
  }
  code_template(w, "} @_ALIGNED @_line_");
  fprintf(w->out, "%d;\n", code_line.number);
}

/* Functions of all lines; 0: no temporary file, or too long. */
static int code_write_lines(const code *w)
{
  int good = 1;
  for (int k = 0; k < code_model.body->lines.n_line && good; k++) {
    code draft = *w;
    draft.out = tmpfile();
    if (!draft.out) {
      return 0;
    }
    code_line_begin(k);
    code_line_center();
    for (int n = code_hold_next(code_carrying, 1); n >= 0; n = code_hold_next(code_carrying, n + 1)) {
      code_line.carries++;
    }
    code_line_tables(w);
    good = code_write_pruned(&draft, code_line_pose, 0) && code_write_pruned(&draft, code_line_inertia, 0) &&
           code_write_pruned(&draft, code_line_drift, 0) && code_write_pruned(&draft, code_line_gradient, 0);
    for (int n = code_hold_next(code_held, 1); n >= 0 && good; n = code_hold_next(code_held, n + 1)) {
      good = code_write_pruned(&draft, code_hold_write, n);
    }
    code_line_type(w);
    rewind(draft.out);
    for (int c = fgetc(draft.out); c != EOF; c = fgetc(draft.out)) {
      fputc(c, w->out);
    }
    good = fclose(draft.out) == 0 && good;
    code_lines[k] = code_line;
  }
  return good;
}

static const char *code_line_refusal(const fb_lines *all)
{
  for (int k = 0; k < all->n_line; k++) {
    if (all->line[k].hangs || all->line[k].carries) {
      return "lines that hang on lines: choose lines whose roots are on the frame";
    }
    if (all->line[k].n_turn == 0) {
      return "lines that do not bend: choose modes of bending or torsion";
    }
  }
  return NULL;
}
#endif
