/* code.h - writes the rk4 step of one body as C99 of its own, straight-line: what code_model.h knows of a fb_body, and
   code_line.h of its lines, in the words of code_text.h. The equations and checks are those of fb_rk4_step. Include
   flexbeam.h first. */
#ifndef CODE_H
#define CODE_H
#include "code_lanes.h"
#include "code_loads.h"
#include "code_model.h"
#include "code_read.h"
#include "code_rotors.h"
#include "code_text.h"
#include "../common/output.h"

/* What an evaluation has written so far. */
typedef struct code_rates {
  code_value lambda[6][FB_MAX_MODES];
  code_value turned[6][FB_MAX_MODES]; /* Lambda M^-1 */
  code_value slope[CODE_POLY][FB_MAX_MODES], value[CODE_POLY];
  int valued[CODE_POLY]; /* 1: the polynomial's value is known */
  code_value S[21], y[6], V[6];
  code_value pb[FB_MAX_MODES], q_dot[FB_MAX_MODES], x[FB_MAX_MODES];
  code_value pi[FB_MAX_MODES]; /* without those of rotors */
} code_rates;

static code_rates code_now;

static code_value code_q(int a)
{
  return code_variable("q_%d", a);
}

/* ---- blocks of the rates */

static void code_write_state(const code *w)
{
  static const char *const frame[10] = {"quat_w", "quat_x", "quat_y", "quat_z", "ux", "uy", "uz", "hx", "hy", "hz"};
  const char *const type = code_real(w);
  code_template(
      w, "  /* quaternion; velocity of the mass center [m/s], inertial axes; angular momentum about it [N m s], body\n"
         "     axes; coordinates and momenta of the modes */\n");
  for (int i = 0; i < 10; i++) {
    fprintf(w->out, "  const %s %s = x[%d];\n", type, frame[i], i);
  }
  for (int a = 0; a < w->n; a++) {
    fprintf(w->out, "  const %s q_%d = x[%d];\n  const %s p_%d = x[%d];\n", type, a, 10 + a, type, a, 10 + w->n + a);
  }
}

static void code_write_lambda(const code *w)
{
  code_sum s;
  fputs(w->n > 0 ? "\n  /* E8.9: Lambda(q), momenta of the frame by rates of the modes */\n" : "", w->out);
  for (int i = 0; i < 6; i++) {
    for (int b = 0; b < w->n; b++) {
      code_begin(&s);
      code_add_one(&s, code_model.lambda[i].constant[b], code_constant(1.0));
      for (int a = 0; a < w->n; a++) {
        code_add_one(&s, code_model.lambda[i].slope[b][a], code_q(a));
      }
      code_now.lambda[i][b] = code_end(w, &s, code_variable("L_%s_%d", code_rows[i], b));
    }
  }
}

/* y = M^-1 x by names; the unit matrix leaves x. */
static void code_write_solve(const code *w, code_value *y, const code_value *x, const char *name)
{
  code_sum s;
  for (int a = 0; a < w->n; a++) {
    code_begin(&s);
    for (int b = 0; b < w->n; b++) {
      code_add_one(&s, code_model.W[a][b], x[b]);
    }
    y[a] = code_end(w, &s, code_variable("%s_%d", name, a));
  }
}

static void code_write_momenta(const code *w)
{
  static const char *const h[6] = {"", "", "", "hx", "hy", "hz"};
  code_sum s;
  fputs("\n  /* E8.13: y = (0, h) - Lambda M^-1 pi */\n", w->out);
  code_write_solve(w, code_now.pb, code_now.pi, "b");
  for (int i = code_model.first; i < 6; i++) {
    code_begin(&s);
    if (i >= 3) {
      code_add_one(&s, 1.0, code_variable("%s", h[i]));
      code_add_rotors(&s, -1.0, i - 3);
    }
    for (int b = 0; b < w->n; b++) {
      code_add(&s, -1.0, code_now.lambda[i][b], code_now.pb[b]);
    }
    code_now.y[i] = code_end(w, &s, code_variable("y_%s", code_rows[i]));
  }
}

/* Gradient of polynomial k by its scale; that of c(q) is in Lambda. */
static void code_write_slope(const code *w, int k)
{
  const code_poly *const p = &code_model.poly[k];
  const double share = 1.0 / code_model.scale[k];
  code_sum s;
  for (int a = 0; a < w->n; a++) {
    if (k < 3) {
      code_now.slope[k][a] = code_now.lambda[k][a];
      continue;
    }
    code_begin(&s);
    code_add_one(&s, share * p->linear[a], code_constant(1.0));
    for (int b = 0; b < w->n; b++) {
      code_add_one(&s, share * p->square[a][b], code_q(b));
    }
    code_now.slope[k][a] = code_end(w, &s, code_variable("d%s_%d", code_model.name[k], a));
  }
}

/* side[a] = 1 or 2 so that all products of p are of coordinates of different sides; 0: there is no such choice. */
static int code_sides(int side[FB_MAX_MODES], const code_poly *p)
{
  int queue[FB_MAX_MODES], n = 0;
  memset(side, 0, FB_MAX_MODES * sizeof *side);
  for (int start = 0, done = 0; start < code_model.n; start++) {
    if (side[start] == 0) {
      side[start] = 2;
      queue[n++] = start;
    }
    for (; done < n; done++) {
      const int a = queue[done];
      for (int b = 0; b < code_model.n; b++) {
        if (fabs(p->square[a][b]) > 0.0 && side[b] == side[a]) {
          return 0;
        }
        if (fabs(p->square[a][b]) > 0.0 && side[b] == 0) {
          side[b] = 3 - side[a];
          queue[n++] = b;
        }
      }
    }
  }
  return 1;
}

/* Polynomial k whose products are of coordinates of two sides: the products by the gradients of one. */
static void code_write_bilinear(const code *w, int k, const int side[FB_MAX_MODES])
{
  const code_poly *const p = &code_model.poly[k];
  code_sum s;
  code_begin(&s);
  code_vary_add(&s, p->constant, p->hub);
  for (int a = 0; a < w->n; a++) {
    if (side[a] == 1) {
      code_add(&s, code_model.scale[k], code_now.slope[k][a], code_q(a));
    } else {
      code_add_one(&s, p->linear[a], code_q(a));
    }
  }
  code_now.value[k] = code_end(w, &s, code_variable("%s", code_model.name[k]));
}

/* Polynomial k by its gradient: constant + 1/2 (linear + gradient).q */
static void code_write_value(const code *w, int k)
{
  const code_poly *const p = &code_model.poly[k];
  const char *const name = code_model.name[k];
  const double scale = code_model.scale[k];
  code_value half;
  code_sum s;
  int side[FB_MAX_MODES];
  if (code_now.valued[k]) {
    return;
  }
  code_now.valued[k] = 1;
  if (code_sides(side, p)) {
    code_write_bilinear(w, k, side);
    return;
  }
  code_begin(&s);
  for (int a = 0; a < w->n; a++) {
    if (!code_is_constant(&code_now.slope[k][a])) {
      code_add(&s, 1.0, code_now.slope[k][a], code_q(a));
      code_add_one(&s, p->linear[a] / scale, code_q(a));
    }
  }
  half = code_end(w, &s, code_variable("h%s", name));
  code_begin(&s);
  code_vary_add(&s, p->constant, p->hub);
  code_add_one(&s, 0.5 * scale, half);
  for (int a = 0; a < w->n; a++) {
    if (code_is_constant(&code_now.slope[k][a])) {
      code_add(&s, scale, code_now.slope[k][a], code_q(a));
    }
  }
  code_now.value[k] = code_end(w, &s, code_variable("%s", name));
}

static int code_is_linear(const code_poly *p)
{
  for (int a = 0; a < code_model.n; a++) {
    for (int b = 0; b < code_model.n; b++) {
      if (fabs(p->square[a][b]) > 0.0) {
        return 0;
      }
    }
  }
  return 1;
}

/* Element e of S(q): as it is where it is linear in q, else by M_rr. */
static void code_write_S(const code *w, int e)
{
  const int i = fbi_sym6_row[e], j = fbi_sym6_column[e], linear = code_is_linear(&code_model.S[e]);
  code_sum s;
  for (int m = 0; m < code_model.n_part[e] && !linear; m++) {
    code_write_value(w, code_model.part[e][m]);
  }
  code_begin(&s);
  if (linear) {
    code_vary_add(&s, code_model.S[e].constant, code_model.S[e].hub);
  }
  for (int m = 0; m < code_model.n_part[e] && !linear; m++) {
    code_add_one(&s, code_model.sign[e][m], code_now.value[code_model.part[e][m]]);
  }
  for (int b = 0; b < w->n; b++) {
    if (linear) {
      code_add_one(&s, code_model.S[e].linear[b], code_q(b));
    } else {
      code_add(&s, -1.0, code_now.lambda[i][b], code_now.turned[j][b]);
    }
  }
  code_now.S[e] = code_end(w, &s, code_variable("S_%s_%s", code_rows[i], code_rows[j]));
}

static void code_write_inertia(const code *w)
{
  fputs(
      w->n > 0
          ? "\n  /* gradients of M_rr(q): of moments of inertia M, second moments of mass E, halved where of M_w_w and "
            "E */\n"
          : "",
      w->out);
  memset(code_now.valued, 0, sizeof code_now.valued);
  for (int k = 0; k < code_model.n_poly; k++) {
    code_write_slope(w, k);
  }
  if ((code_model.constant_S && !(w->vary & CODE_HUB)) || code_model.large) {
    return;
  }
  fputs("\n  /* E8.11: S(q) = M_rr - Lambda M^-1 Lambda^T; c [kg m]: first moment of mass */\n", w->out);
  for (int i = code_model.first; i < 6 && !code_model.constant_S; i++) {
    char name[CODE_NAME];
    snprintf(name, sizeof name, "T_%s", code_rows[i]);
    code_write_solve(w, code_now.turned[i], code_now.lambda[i], name);
  }
  for (int e = 0; e < 21; e++) {
    if (fbi_sym6_row[e] >= code_model.first) {
      code_write_S(w, e);
    }
  }
}

/* ---- the solution of S V = y, with lines of M and S at once */

enum { CODE_SPEEDS = FB_MAX_MODES > 24 ? FB_MAX_MODES : 24, CODE_ROWS = CODE_SPEEDS + 6 };

typedef struct code_factor { /* in the order of elimination */
  int n, order[6];           /* rows that the base leaves free */
  char label[CODE_ROWS][16];
  code_value S[CODE_ROWS][CODE_ROWS];
  code_value low[CODE_ROWS][CODE_ROWS];  /* unit lower triangle.. */
  code_value raw[CODE_ROWS][CODE_ROWS];  /* ..and it times the pivots */
  code_value share[CODE_ROWS];           /* 1/pivot */
  code_value y[CODE_ROWS], x[CODE_ROWS]; /* right side, solution */
} code_factor;

static code_factor code_solver;

/* Order of elimination: pivots that are constants first, then those with few elements beside them. */
static void code_order(code_factor *f)
{
  int full[6][6] = {{0}}, varies[6] = {0}, done[6] = {0};
  for (int i = 0; i < code_model.first; i++) {
    done[i] = 1;
  }
  for (int i = code_model.first; i < 6; i++) {
    for (int j = code_model.first; j < 6; j++) {
      full[i][j] = !code_is_zero(&code_now.S[fb_sym6_index(i, j)]);
    }
    varies[i] = !code_is_constant(&code_now.S[fb_sym6_index(i, i)]);
  }
  f->n = 6 - code_model.first;
  for (int k = 0; k < f->n; k++) {
    int best = -1, least = 0;
    for (int i = 0; i < 6; i++) {
      int cost = 100 * varies[i];
      for (int j = 0; j < 6; j++) {
        cost += full[i][j] && !done[j];
      }
      if (!done[i] && (best < 0 || cost < least)) {
        best = i;
        least = cost;
      }
    }
    done[best] = 1;
    f->order[k] = best;
    strcpy(f->label[k], code_rows[best]);
    for (int i = 0; i < 6; i++) {
      for (int j = 0; j < 6; j++) {
        if (full[best][i] && full[best][j]) {
          full[i][j] = 1;
          varies[i] |= i == j && !code_is_constant(&code_now.S[fb_sym6_index(best, i)]);
        }
      }
    }
  }
}

static const char *code_row_at(const code_factor *f, int k)
{
  return f->label[k];
}

/* Pivot k and its inverse. */
static void code_write_pivot(const code *w, code_factor *f, int k)
{
  code_sum s;
  code_value pivot;
  code_begin(&s);
  code_add_one(&s, 1.0, f->S[k][k]);
  for (int m = 0; m < k; m++) {
    code_add(&s, -1.0, f->low[k][m], f->raw[k][m]);
  }
  pivot = f->raw[k][k] = code_end(w, &s, code_variable("d_%s", code_row_at(f, k)));
  if (code_is_constant(&pivot)) {
    f->share[k] = code_constant(1.0 / pivot.c);
    return;
  }
  f->share[k] = code_variable("r_%s", code_row_at(f, k));
  fprintf(w->out, "  const %s %s = ", code_real(w), f->share[k].name);
  code_template(w, "`1` / ");
  fprintf(w->out, "%s;\n", pivot.name);
}

/* Column k below its pivot. */
static void code_write_column(const code *w, code_factor *f, int k)
{
  code_sum s;
  for (int j = k + 1; j < f->n; j++) {
    code_begin(&s);
    code_add_one(&s, 1.0, f->S[j][k]);
    for (int m = 0; m < k; m++) {
      code_add(&s, -1.0, f->low[k][m], f->raw[j][m]);
    }
    f->raw[j][k] = code_end(w, &s, code_variable("f_%s_%s", code_row_at(f, j), code_row_at(f, k)));
    code_begin(&s);
    code_add(&s, 1.0, f->raw[j][k], f->share[k]);
    f->low[j][k] = code_end(w, &s, code_variable("l_%s_%s", code_row_at(f, j), code_row_at(f, k)));
  }
}

/* Begins the refusal where a pivot is `most` epsilons of its element or less; 0: none varies. */
static int code_write_pivots(const code *w, const code_factor *f, double most)
{
  int n = 0;
  code_sum s;
  for (int k = 0; k < f->n; k++) {
    if (!code_is_constant(&f->raw[k][k])) {
      char number[40];
      code_number(number, w, most * (w->single ? (double)FLT_EPSILON : DBL_EPSILON));
      fputs(n++ == 0 ? "  if (!(" : " &&\n        ", w->out);
      code_template(w, "%(");
      fprintf(w->out, "%s > %s * ", f->raw[k][k].name, number);
      code_begin(&s);
      code_add_one(&s, 1.0, f->S[k][k]);
      code_expression(w, &s, 60);
      code_template(w, "%)");
    }
  }
  fputs(n > 0 ? ")) {\n    return " : "", w->out);
  return n > 0;
}

/* Refusal where a pivot is round-off. */
static void code_write_pivot_check(const code *w, const code_factor *f)
{
  if (code_write_pivots(w, f, 8.0)) {
    if (code_model.first == 6 || w->lanes) {
      code_template(w, "@_range;\n  }\n");
      return;
    }
    for (int e = 0, m = 0; e < 21; e++) {
      if (fbi_sym6_row[e] >= (code_lines[0].centered ? 3 : code_model.first) && !code_is_constant(&code_now.S[e])) {
        fprintf(w->out, "%s%s(%s)",
                m == 0       ? ""
                : m % 4 == 0 ? " +\n           "
                             : " + ",
                w->single ? "fabsf" : "fabs", code_now.S[e].name);
        m++;
      }
    }
    code_template(w, w->single ? " <= `1e18` ? @_range : @_not_finite;\n  }\n"
                               : " <= `1e150` ? @_range : @_not_finite;\n  }\n");
  }
}

/* z = L^-1 y */
static void code_write_forward(const code *w, const code_factor *f, code_value z[CODE_ROWS])
{
  code_sum s;
  for (int k = 0; k < f->n; k++) {
    code_begin(&s);
    code_add_one(&s, 1.0, f->y[k]);
    for (int m = 0; m < k; m++) {
      code_add(&s, -1.0, f->low[k][m], z[m]);
    }
    z[k] = code_end(w, &s, code_variable("z_%s", code_row_at(f, k)));
  }
}

/* x = L^-T D^-1 z, called as `names` say. */
static void code_write_backward(const code *w, code_factor *f, const code_value z[CODE_ROWS],
                                char names[CODE_ROWS][CODE_NAME])
{
  code_sum s;
  for (int k = f->n - 1; k >= 0; k--) {
    code_begin(&s);
    code_add(&s, 1.0, z[k], f->share[k]);
    for (int m = k + 1; m < f->n; m++) {
      code_add(&s, -1.0, f->low[m][k], f->x[m]);
    }
    f->x[k] = code_end(w, &s, code_variable("%s", names[k]));
  }
}

/* The solution x by substitution, called as `names` say. */
static void code_write_substitution(const code *w, code_factor *f, char names[CODE_ROWS][CODE_NAME])
{
  code_value z[CODE_ROWS];
  code_write_forward(w, f, z);
  code_write_backward(w, f, z, names);
}

/* Solves it. */
static void code_write_factor(const code *w, code_factor *f, char names[CODE_ROWS][CODE_NAME])
{
  for (int k = 0; k < f->n; k++) {
    code_write_pivot(w, f, k);
    code_write_column(w, f, k);
  }
  code_write_pivot_check(w, f);
  code_write_substitution(w, f, names);
}

static void code_write_constant_velocities(const code *w)
{
  code_sum s;
  for (int i = code_model.first; i < 6; i++) {
    code_begin(&s);
    for (int j = code_model.first; j < 6; j++) {
      code_add_one(&s, (double)code_model.body->S0_inverse[6 * i + j], code_now.y[j]);
    }
    code_now.V[i] = code_end(w, &s, code_variable("%s", code_rows[i]));
  }
}

/* Velocities that have got no variable of their own get one, for what follows in templates. */
static void code_write_names(const code *w)
{
  code_sum s;
  for (int i = 0; i < 6; i++) {
    if (strcmp(code_now.V[i].name, code_rows[i]) != 0) {
      code_begin(&s);
      code_add_one(&s, 1.0, code_now.V[i]);
      code_declare(w, &s, code_rows[i]);
    }
  }
}

/* Velocities of a prescribed base, relative to u. */
static void code_write_given(const code *w)
{
  code_template(w, "\n  /* E8.35: velocities of the base relative to u, body axes */\n"
                   "  const $ vx = act->v[0] - R[0] * ux - R[3] * uy - R[6] * uz;\n"
                   "  const $ vy = act->v[1] - R[1] * ux - R[4] * uy - R[7] * uz;\n"
                   "  const $ vz = act->v[2] - R[2] * ux - R[5] * uy - R[8] * uz;\n"
                   "  const $ wx = act->w[0], wy = act->w[1], wz = act->w[2];\n");
  for (int i = 0; i < 6; i++) {
    code_now.V[i] = code_variable("%s", code_rows[i]);
  }
}

static void code_write_velocities(const code *w)
{
  static char names[CODE_ROWS][CODE_NAME];
  code_factor *const f = &code_solver;
  if (code_model.first == 6) {
    code_write_given(w);
    return;
  }
  for (int i = 0; i < code_model.first; i++) {
    code_now.V[i] = code_constant(0.0);
  }
  fputs("\n  /* E8.13: V = S^-1 y, velocity [m/s] and angular velocity [rad/s] of the frame relative to the mass "
        "center, body\n"
        "     axes */\n",
        w->out);
  if (code_model.constant_S && !(w->vary & CODE_HUB)) {
    code_write_constant_velocities(w);
    code_write_names(w);
    return;
  }
  code_order(f);
  for (int i = 0; i < f->n; i++) {
    for (int j = 0; j < f->n; j++) {
      f->S[i][j] = code_now.S[fb_sym6_index(f->order[i], f->order[j])];
    }
    f->y[i] = code_now.y[f->order[i]];
    strcpy(names[i], code_rows[f->order[i]]);
  }
  code_write_factor(w, f, names);
  for (int i = 0; i < f->n; i++) {
    code_now.V[f->order[i]] = f->x[i];
  }
  code_write_names(w);
}

#include "code_central.h"
/* ---- forces */

static void code_write_q_dot(const code *w)
{
  code_value e[FB_MAX_MODES];
  code_sum s;
  fputs("\n  /* E8.17: q_dot = M^-1 (pi - Lambda^T V) */\n", w->out);
  for (int b = 0; b < w->n; b++) {
    code_begin(&s);
    code_add_one(&s, 1.0, code_now.pi[b]);
    for (int i = 0; i < 6; i++) {
      code_add(&s, -1.0, code_now.lambda[i][b], code_now.V[i]);
    }
    e[b] = code_end(w, &s, code_variable(code_model.body->unit_mass ? "rate_%d" : "e_%d", b));
  }
  code_write_solve(w, code_now.q_dot, e, "rate");
}

/* Does Lambda, or S, depend on q? */
static int code_row_varies(int i)
{
  for (int b = 0; b < code_model.n; b++) {
    for (int a = 0; a < code_model.n; a++) {
      if (fabs(code_model.lambda[i].slope[b][a]) > 0.0) {
        return 1;
      }
    }
  }
  return 0;
}

/* V_i (d Lambda_i/dq_a) x: named products of the rows that vary, by coordinate a; x: q_dot, or M^-1 pi where S is
   constant. */
static void code_write_gyration(const code *w, code_sum *x)
{
  const code_value *const by = code_model.constant_S ? code_now.pb : code_now.q_dot;
  code_sum s;
  for (int i = 0; i < 6; i++) {
    if (!code_row_varies(i)) {
      continue;
    }
    for (int a = 0; a < w->n; a++) {
      code_value t;
      code_begin(&s);
      for (int b = 0; b < w->n; b++) {
        code_add_one(&s, code_model.lambda[i].slope[b][a], by[b]);
      }
      t = code_end(w, &s, code_variable("n_%s_%d", code_rows[i], a));
      code_add(&x[a], 1.0, code_now.V[i], t);
    }
  }
}

/* Weight of polynomial k in 1/2 V^T M_rr V. */
static code_value code_write_weight(const code *w, int k)
{
  code_sum s;
  code_begin(&s);
  for (int e = 0; e < 21; e++) {
    const int i = fbi_sym6_row[e], j = fbi_sym6_column[e];
    for (int m = 0; m < code_model.n_part[e]; m++) {
      if (code_model.part[e][m] == k) {
        code_add(&s, code_model.scale[k] * code_model.sign[e][m] * (i == j ? 0.5 : 1.0), code_now.V[i], code_now.V[j]);
      }
    }
  }
  code_add_center_weight(&s, k);
  return code_end(w, &s, code_variable("W_%s", code_model.name[k]));
}

static int code_slope_is_zero(int k)
{
  for (int a = 0; a < code_model.n; a++) {
    if (!code_is_zero(&code_now.slope[k][a])) {
      return 0;
    }
  }
  return 1;
}

/* x += what E8.10 and E8.12 give: weights times gradients, gyroscopic terms. */
static void code_write_gradient(const code *w, code_sum *x)
{
  fputs("\n  /* E8.10, E8.12: 1/2 V^T (dM_rr/dq) V + V^T (dLambda/dq) q_dot */\n", w->out);
  for (int k = 0; k < code_model.n_poly; k++) {
    if (!code_slope_is_zero(k)) {
      const code_value weight = code_write_weight(w, k);
      for (int a = 0; a < w->n; a++) {
        code_add(&x[a], 1.0, weight, code_now.slope[k][a]);
      }
    }
  }
  code_write_gyration(w, x);
}

static code_sum code_force[FB_MAX_MODES];

/* dT/dq_a of the line that coordinate a deforms. */
static code_value code_large_gradient(int a)
{
  for (int k = 0; k < code_model.body->lines.n_line; k++) {
    const fb_line *const line = &code_model.body->lines.line[k];
    if (a >= line->first && a < line->first + line->n) {
      return code_variable("line_%d.g[%d]", k, a - line->first);
    }
  }
  return code_constant(0.0);
}

static void code_write_pi_dot(const code *w)
{
  static double K[FB_MAX_MODES][FB_MAX_MODES], C[FB_MAX_MODES][FB_MAX_MODES];
  const fb_body *const body = code_model.body;
  code_read_springs(K, C, body);
  for (int a = 0; a < w->n; a++) {
    code_begin(&code_force[a]);
    for (int b = 0; b < w->n; b++) {
      code_add(&code_force[a], -K[a][b], code_q(b), code_factor_of(w, CODE_STIFFNESS | CODE_MASS, "stiffness"));
    }
    for (int b = 0; b < w->n; b++) {
      code_add(&code_force[a], -C[a][b], code_now.q_dot[b], code_factor_of(w, CODE_DAMPED, "damping"));
    }
  }
  code_write_gradient(w, code_force);
  for (int a = 0; a < w->n && w->large; a++) {
    code_add_one(&code_force[a], 1.0, code_large_gradient(a));
  }
  code_write_rotor_speeds(w, code_force, code_now.V, code_now.q_dot);
  code_write_center_rotors(w, code_force);
  fputs("\n  /* E8.17: pi_dot = that - K q - C q_dot */\n", w->out);
  for (int a = 0; a < w->n; a++) {
    char target[32];
    code_sum s;
    snprintf(target, sizeof target, "rate[%d]", 10 + w->n + a);
    code_assign(w, &code_force[a], target);
    code_begin(&s);
    code_add_one(&s, 1.0, code_now.q_dot[a]);
    snprintf(target, sizeof target, "rate[%d]", 10 + a);
    code_assign(w, &s, target);
  }
}

static const char code_attitude[] = "\n  /* E4.4, E8.18: attitude, place, angular momentum in body axes */\n"
                                    "  rate[0] = `-0.5` * (quat_x * wx + quat_y * wy + quat_z * wz);\n"
                                    "  rate[1] = `0.5` * (quat_w * wx + quat_y * wz - quat_z * wy);\n"
                                    "  rate[2] = `0.5` * (quat_w * wy + quat_z * wx - quat_x * wz);\n"
                                    "  rate[3] = `0.5` * (quat_w * wz + quat_x * wy - quat_y * wx);\n";

static const char code_turning[] = "  rate[7] = hy * wz - hz * wy;\n"
                                   "  rate[8] = hz * wx - hx * wz;\n"
                                   "  rate[9] = hx * wy - hy * wx;\n";

static const char code_flying[] = "  rate[%r] = ux;\n"
                                  "  rate[%r + 1] = uy;\n"
                                  "  rate[%r + 2] = uz;\n";

static const char code_driven[] = "  rate[7] = rate[8] = rate[9] = %z;\n"
                                  "  rate[%r] = ux + R[0] * vx + R[1] * vy + R[2] * vz;\n"
                                  "  rate[%r + 1] = uy + R[3] * vx + R[4] * vy + R[5] * vz;\n"
                                  "  rate[%r + 2] = uz + R[6] * vx + R[7] * vy + R[8] * vz;\n";

static const char code_spin[] = "  rate[%l] = rate[%l + 1] = rate[%l + 2] = %z;\n"
                                "  w[0] = wx;\n  w[1] = wy;\n  w[2] = wz;\n  *a = %z;\n";

static void code_write_frame(const code *w)
{
  code_template(w, code_attitude);
  code_template(w, code_model.first == 6 ? code_driven : code_turning);
  if (code_model.first == 0 || (code_model.first == 3 && w->central)) { /* u of a pin is 0, or no number */
    code_template(w, code_flying);
  } else if (code_model.first == 3) {
    code_template(w, "  rate[%r] = rate[%r + 1] = rate[%r + 2] = %z;\n");
  }
  code_template(w, code_spin);
  for (int i = 0; i < 3; i++) {
    char number[40];
    code_number(number, w, code_model.first == 0 ? code_gravity(i) : 0.0);
    fprintf(w->out, w->lanes ? "  rate[%d] = %s_wide_all(%s);\n" : "  rate[%d] = %.0s%s;\n", 4 + i, w->name, number);
  }
}

/* ---- loads of bases that do not fly: gravity pulls */

static const char code_pinned_torque[] =
    "  rate[7] += tx;\n  rate[8] += ty;\n  rate[9] += tz;\n"
    "  for (int i = 0; i < 3; i++) {\n"
    "    rate[%l + i] = R[3 * i] * tx + R[3 * i + 1] * ty + R[3 * i + 2] * tz;\n  }\n"
    "  *a = @_norm(G);\n";

static const char code_given_acceleration[] =
    "  const $ forward[3] = {act->v_dot[0] + wy * act->v[2] - wz * act->v[1],\n"
    "                        act->v_dot[1] + wz * act->v[0] - wx * act->v[2],\n"
    "                        act->v_dot[2] + wx * act->v[1] - wy * act->v[0]};\n"
    "  *a = @_norm(G) + @_norm(forward);\n";

/* Gravity G, inertial axes, and gx, gy, gz, body axes. */
static void code_write_field(const code *w)
{
  const char *const type = code_real(w);
  char number[40];
  fputs("\n  /* E8.16: gravity, first moment of mass c */\n", w->out);
  for (int i = 0; i < 3; i++) {
    code_number(number, w, code_gravity(i));
    if (i == 0) {
      fprintf(w->out, "  const %s G[3] = {", type);
    }
    fprintf(w->out, "%s + act->gravity[%d]%s", number, i, i < 2 ? ", " : "};\n");
  }
  for (int i = 0; i < 3; i++) {
    fprintf(w->out, "  const %s g%c = R[%d] * G[0] + R[%d] * G[1] + R[%d] * G[2];\n", type, 'x' + i, i, 3 + i, 6 + i);
  }
}

static void code_write_pull(const code *w)
{
  code_sum s;
  char target[32];
  code_write_field(w);
  code_write_node_loads(w, "act");
  for (int k = 0; k < 3 && code_model.first == 3; k++) {
    code_write_value(w, k);
  }
  for (int i = 0; i < 3 && code_model.first == 3; i++) {
    const int y = (i + 1) % 3, z = (i + 2) % 3;
    code_begin(&s);
    code_add(&s, 1.0, code_variable("act->torque[%d]", i), code_factor_of(w, CODE_MASS, "share"));
    code_add_node_torques(&s, i);
    code_add(&s, 1.0, code_now.value[y], code_variable("g%c", 'x' + z));
    code_add(&s, -1.0, code_now.value[z], code_variable("g%c", 'x' + y));
    code_add_center_torque(&s, i);
    snprintf(target, sizeof target, "t%c", 'x' + i);
    code_declare(w, &s, target);
  }
  for (int a = 0; a < w->n; a++) {
    snprintf(target, sizeof target, "rate[%d]", 10 + w->n + a);
    code_begin(&s);
    code_add_one(&s, 1.0, code_variable("%s", target));
    code_add(&s, 1.0, code_variable("act->modal[%d]", a), code_factor_of(w, CODE_MASS, "share"));
    code_add_node_modal(&s, a);
    for (int i = 0; i < 3; i++) {
      code_add(&s, 1.0, code_now.lambda[i][a], code_variable("g%c", 'x' + i));
    }
    code_assign(w, &s, target);
  }
  code_template(w, code_model.first == 3 ? code_pinned_torque : code_given_acceleration);
  if (w->central) {
    code_write_center_pull(w);
  }
  code_template(w, "  return @_ok;\n}\n");
}

/* ---- loads of a free body */

static const char code_load_head[] =
    "\n  /* E8.15, E8.33: loads at O, in the frame of the mass center, which they accelerate by a = f/m; E8.18 */\n"
    "  if (in) {\n";

static const char *const code_wrench[2] = {
    "    const $ *const F = in->force, *const T = in->torque;\n",
    "    const $ F[3] = {model->share * in->force[0], model->share * in->force[1], model->share * in->force[2]};\n"
    "    const $ T[3] = {model->share * in->torque[0], model->share * in->torque[1], model->share * in->torque[2]};\n"};

static const char code_twisted[] = "    rate[7] += gx;\n    rate[8] += gy;\n    rate[9] += gz;\n";

static const char code_inertial[] =
    "    for (int i = 0; i < 3; i++) {\n"
    "      rate[4 + i] += R[3 * i] * ax + R[3 * i + 1] * ay + R[3 * i + 2] * az + in->gravity[i];\n"
    "      rate[%l + i] = R[3 * i] * gx + R[3 * i + 1] * gy + R[3 * i + 2] * gz;\n"
    "    }\n"
    "    *a = sqrt~(ax * ax + ay * ay + az * az);\n"
    "  }\n";

/* Torque about the mass center, axis i: T - c x a. */
static void code_write_torque(const code *w, int i)
{
  const int y = (i + 1) % 3, z = (i + 2) % 3;
  char target[32];
  code_sum s;
  code_begin(&s);
  code_add_one(&s, 1.0, code_variable("T[%d]", i));
  code_add(&s, -1.0, code_now.value[y], code_variable("a%c", 'x' + z));
  code_add(&s, 1.0, code_now.value[z], code_variable("a%c", 'x' + y));
  snprintf(target, sizeof target, "g%c", 'x' + i);
  code_declare(w, &s, target);
}

/* Force and torque about O of all loads. */
static void code_write_wrench(const code *w)
{
  const code_value share = code_factor_of(w, CODE_MASS, "share");
  code_sum s;
  char target[32];
  code_template(w, "    $ F[3], T[3];\n");
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add(&s, 1.0, share, code_variable("in->force[%d]", i));
    code_add_node_forces(&s, i);
    snprintf(target, sizeof target, "F[%d]", i);
    code_assign(w, &s, target);
    code_begin(&s);
    code_add(&s, 1.0, share, code_variable("in->torque[%d]", i));
    code_add_node_torques(&s, i);
    snprintf(target, sizeof target, "T[%d]", i);
    code_assign(w, &s, target);
  }
}

static void code_write_loads(const code *w)
{
  code inner = *w;
  inner.indent = 4;
  code_template(w, code_load_head);
  code_write_node_loads(&inner, "in");
  if (code_loads_any()) {
    code_write_wrench(&inner);
  } else {
    code_template(w, code_wrench[(w->vary & CODE_MASS) != 0]);
  }
  code_template(w, w->central ? "" : "    $ R[9];\n");
  for (int k = 0; k < 3; k++) {
    char number[40], name[4] = {'a', (char)('x' + k), 0};
    code_write_value(&inner, k);
    code_inverse_mass(number, w);
    fprintf(w->out, "    const %s %s = %s * F[%d];\n", code_real(w), name, number, k);
  }
  for (int i = 0; i < 3; i++) {
    code_write_torque(&inner, i);
  }
  for (int a = 0; a < w->n; a++) {
    char target[32];
    code_sum s;
    code_begin(&s);
    snprintf(target, sizeof target, "rate[%d]", 10 + w->n + a);
    code_add_one(&s, 1.0, code_variable("%s", target));
    code_add(&s, 1.0, code_variable("in->modal[%d]", a), code_factor_of(w, CODE_MASS, "share"));
    code_add_node_modal(&s, a);
    for (int i = 0; i < 3; i++) {
      code_add(&s, -1.0, code_now.lambda[i][a], code_variable("a%c", 'x' + i));
    }
    code_assign(&inner, &s, target);
  }
  code_template(w, code_twisted);
  code_template(w, w->central ? "" : "    @_matrix(R, x);\n");
  code_template(w, code_inertial);
  if (w->central) {
    code_write_fall(w);
  }
  code_template(w, "  return @_ok;\n}\n");
}

/* ---- bodies with lines (code_line.h): their functions with the rest of the body */

/* Line axes to body axes. */
static double code_large_axes(int k, int i, int j)
{
  const fb_line *const line = &code_model.body->lines.line[k];
  return line->turned ? (double)line->axes[3 * i + j] : i == j ? 1.0 : 0.0;
}

/* Calls function `name` of line k with the variable in which it is. */
static void code_write_large_call(const code *w, const char *name, int k)
{
  code_template(w, "@_");
  fprintf(w->out, "%s_%d(&%s", name, code_lines[k].number, code_variable("line_%d", k).name);
}

/* Poses of all lines at coordinates q + at; sound: no interval turns too far. */
static void code_write_large_poses(const code *w, const char *q, int at)
{
  fprintf(w->out, "  int %ssound = 1;\n", code_of_names);
  for (int k = 0; k < code_model.body->lines.n_line; k++) {
    code_template(w, "  @_line_");
    fprintf(w->out, "%d %s;\n", code_lines[k].number, code_variable("line_%d", k).name);
  }
  for (int k = 0; k < code_model.body->lines.n_line; k++) {
    fprintf(w->out, "  %ssound &= ", code_of_names);
    code_write_large_call(w, "pose", k);
    fprintf(w->out, ", %s + %d);\n", q, at + code_model.body->lines.line[k].first);
  }
}

static void code_write_large_inertias(const code *w, const char *q, int at)
{
  for (int k = 0; k < code_model.body->lines.n_line; k++) {
    const fb_line *const line = &code_model.body->lines.line[k];
    fputs("  ", w->out);
    code_write_large_call(w, "inertia", k);
    fputs(code_lines[k].centered ? ", hub" : "", w->out);
    if (line->moves) {
      fprintf(w->out, ", %s + %d", q, at + line->first);
    }
    fputs(");\n", w->out);
  }
}

/* s += momentum i of coordinate b (which: 'P' linear, 'L' angular) of line k, body axes. */
static void code_large_add(code_sum *s, int k, char which, int i, int b)
{
  const fb_line *const line = &code_model.body->lines.line[k];
  const struct code_line *const own = &code_lines[k];
  for (int j = 0; j < 3 && b >= line->first && b < line->first + line->n; j++) {
    if (which == 'P' && own->centered) { /* row 0 of Y */
      code_add_one(s, code_is_zero(&code_lines[k].Y.x[j]) ? 0.0 : code_large_axes(k, i, j) * own->whole / own->kept,
                   code_variable("line_%d.Y_%c[0][%d]", k, code_axis[j], b - line->first));
    } else {
      code_add_one(s, code_large_axes(k, i, j), code_variable("line_%d.%c[%d][%d]", k, which, j, b - line->first));
    }
  }
}

/* First moment of mass of line k from its pose at q + from, body axes: sum of masses outboard times tangents. */
static code_value code_write_large_center(const code *w, const char *q, int from, int k, int i)
{
  const struct code_line own = code_lines[k];
  code_sum s;
  code_line = own;
  code_begin(&s);
  for (int j = 0; j < 3; j++) {
    const double turn = code_large_axes(k, i, j);
    const fb_lines *const all = code_line.all;
    code_add_one(&s, turn * code_line_moment(j), code_constant(1.0));
    for (int p = 0; p < code_line.line->count; p++) {
      const int at = code_line.line->point + p;
      char place[16];
      code_value t;
      snprintf(place, sizeof place, "%d", p);
      t = code_at(code_line.t.x[j], place);
      if (strncmp(t.name, "l->", 3) == 0) {
        t = code_variable("line_%d.%s", k, code_at(code_line.t.x[j], place).name + 3);
      }
      code_add_one(&s, turn * code_line_outboard(p, -1), t);
      for (int c = 0; c < 3 && code_line.offset; c++) { /* m H center */
        code_value H = code_line.H[j][c];
        const double first = code_line_mass(p) * (double)all->center[3 * at + c];
        if (!code_is_constant(&H)) {
          H = code_variable("line_%d.H_%c%c[%d]", k, code_axis[j], code_axis[c], p);
        }
        code_add_one(&s, turn * first, H);
      }
    }
    for (int a = 0; a < code_line.n; a++) {
      code_add_one(&s, turn * code_line_moment(-1) * code_line_shift(a, j),
                   code_plain("%s[%d]", q, from + code_line.line->first + a));
    }
  }
  return code_end(w, &s, code_variable("c_%c_%d", code_axis[i], k));
}

/* What the lines add to element e of M_rr. */
static void code_large_M(code_sum *s, int e)
{
  static const int packed[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  const int i = fbi_sym6_row[e], j = fbi_sym6_column[e];
  for (int k = 0; k < code_model.body->lines.n_line; k++) {
    code_line = code_lines[k];
    if (i < 3 && j < 3) {
      code_add_one(s, i == j ? code_line_moment(-1) : 0.0, code_constant(1.0));
    } else if (i < 3) {
      const int axis = 3 - i - (j - 3);
      for (int p = 0; p < 3 && j - 3 != i; p++) {
        code_add_one(s, ((j - 3) - i + 3) % 3 == 1 ? code_large_axes(k, axis, p) : -code_large_axes(k, axis, p),
                     code_variable("line_%d.c[%d]", k, p));
      }
    } else {
      for (int p = 0; p < 9; p++) {
        code_add_one(s, code_large_axes(k, i - 3, p / 3) * code_large_axes(k, j - 3, p % 3),
                     code_variable("line_%d.J[%d]", k, packed[p / 3][p % 3]));
      }
    }
  }
}

static code_value code_hub[3]; /* first moment of mass of the rest of the body */

static double code_large_rest_mass(void)
{
  return (double)code_model.body->mass - code_lines[0].whole * code_lines[0].whole;
}

/* Sums relative to the mass center of the whole: what the rest of the body has itself. s += that of element e of M_rr. */
static void code_large_centered(code_sum *s, int e)
{
  const int i = fbi_sym6_row[e] - 3, j = fbi_sym6_column[e] - 3;
  const double share = 1.0 / code_large_rest_mass();
  code_add(s, share, code_hub[i], code_hub[j]);
  for (int k = 0; k < 3 && i == j; k++) {
    code_add(s, -share, code_hub[k], code_hub[k]);
  }
}

/* Lambda, M_rr and c of the whole. */
static void code_write_large_inertia(const code *w)
{
  code_sum s;
  for (int i = 0; i < 6; i++) {
    for (int b = 0; b < w->n; b++) {
      const int y = (i + 1) % 3, z = (i + 2) % 3;
      const int centered = code_lines[0].centered;
      code_begin(&s);
      code_add_one(&s, centered && i < 3 ? (double)code_model.body->mass / code_large_rest_mass() : 1.0,
                   code_now.lambda[i][b]);
      if (centered && i >= 3) { /* - c x P/m of the rest */
        code_add_one(&s, -code_model.lambda[z].constant[b] / code_large_rest_mass(), code_hub[y]);
        code_add_one(&s, code_model.lambda[y].constant[b] / code_large_rest_mass(), code_hub[z]);
      }
      for (int k = 0; k < code_model.body->lines.n_line; k++) {
        code_large_add(&s, k, i < 3 ? 'P' : 'L', i % 3, b);
      }
      code_now.lambda[i][b] = code_end(w, &s, code_variable("X_%s_%d", code_rows[i], b));
    }
  }
  for (int e = 0; e < 21; e++) {
    if (fbi_sym6_row[e] >= (code_lines[0].centered ? 3 : code_model.first)) {
      for (int m = 0; m < code_model.n_part[e]; m++) {
        code_write_value(w, code_model.part[e][m]);
      }
      code_begin(&s);
      for (int m = 0; m < code_model.n_part[e]; m++) {
        code_add_one(&s, code_model.sign[e][m], code_now.value[code_model.part[e][m]]);
      }
      code_large_M(&s, e);
      if (code_lines[0].centered) {
        code_large_centered(&s, e);
      }
      code_now.S[e] =
          code_end(w, &s, code_variable("S_%s_%s", code_rows[fbi_sym6_row[e]], code_rows[fbi_sym6_column[e]]));
    }
  }
  for (int i = 0; i < 3 && code_model.first < 6; i++) {
    code_write_value(w, i);
    code_begin(&s);
    code_add_one(&s, 1.0, code_now.value[i]);
    for (int k = 0; k < code_model.body->lines.n_line; k++) {
      for (int p = 0; p < 3; p++) {
        code_add_one(&s, code_large_axes(k, i, p), code_variable("line_%d.c[%d]", k, p));
      }
    }
    code_now.value[i] = code_end(w, &s, code_variable("all_c_%c", 'x' + i));
  }
}

/* M(q), row a, column b >= a */
static code_value code_write_large_mass(const code *w, int a, int b)
{
  code_sum s;
  code_begin(&s);
  code_add_one(&s, code_model.W[a][b], code_constant(1.0));
  for (int i = 0; i < 3 && code_lines[0].centered; i++) {
    code_add_one(&s, -code_model.lambda[i].constant[a] * code_model.lambda[i].constant[b] / code_large_rest_mass(),
                 code_constant(1.0));
  }
  for (int k = 0; k < code_model.body->lines.n_line; k++) {
    const fb_line *const line = &code_model.body->lines.line[k];
    if (a >= line->first && b < line->first + line->n) {
      code_add_one(&s, 1.0, code_variable("line_%d.M[%d][%d]", k, a - line->first, b - line->first));
    }
  }
  return code_end(w, &s, code_variable("M_%d_%d", a, b));
}

/* Velocity of O relative to the mass center, v = -(w x c + P q_dot)/m. */
static void code_write_large_origin(const code *w)
{
  const double share = -1.0 / (double)code_model.body->mass;
  code_sum s;
  for (int i = 0; i < 3; i++) {
    const int y = (i + 1) % 3, z = (i + 2) % 3;
    code_begin(&s);
    for (int a = 0; a < w->n; a++) {
      code_add(&s, 1.0, code_now.lambda[i][a], code_now.q_dot[a]);
    }
    code_add(&s, 1.0, code_now.V[3 + y], code_now.value[z]);
    code_add(&s, -1.0, code_now.V[3 + z], code_now.value[y]);
    code_now.V[i] = code_end(w, &s, code_variable("p_%c", 'x' + i));
    code_begin(&s);
    code_add_one(&s, share, code_now.V[i]);
    code_now.V[i] = code_end(w, &s, code_variable("%s", code_rows[i]));
  }
}

static void code_write_large_solve(const code *w)
{
  static char names[CODE_ROWS][CODE_NAME];
  static const char *const h[3] = {"hx", "hy", "hz"};
  code_factor *const f = &code_solver;
  const int first = code_lines[0].centered ? 3 : code_model.first; /* of the rows of the frame */
  f->n = w->n + 6 - first;
  for (int a = 0; a < w->n; a++) {
    code_sum s;
    snprintf(f->label[a], sizeof f->label[a], "q%d", a);
    snprintf(names[a], sizeof names[a], "rate_%d", a);
    for (int b = a; b < w->n; b++) {
      f->S[a][b] = f->S[b][a] = code_write_large_mass(w, a, b);
    }
    code_begin(&s);
    code_add_one(&s, 1.0, code_now.pi[a]);
    for (int i = 0; i < 6 && code_model.first == 6; i++) {
      code_add(&s, -1.0, code_now.lambda[i][a], code_now.V[i]);
    }
    f->y[a] = code_end(w, &s, code_variable("e_%d", a));
  }
  for (int i = first; i < 6; i++) {
    const int at = w->n + i - first;
    code_sum s;
    strcpy(f->label[at], code_rows[i]);
    strcpy(names[at], code_rows[i]);
    code_begin(&s);
    if (i >= 3) {
      code_add_one(&s, 1.0, code_variable("%s", h[i - 3]));
      code_add_rotors(&s, -1.0, i - 3);
    }
    f->y[at] = code_end(w, &s, code_variable("y_%s", code_rows[i]));
    for (int a = 0; a < w->n; a++) {
      f->S[at][a] = f->S[a][at] = code_now.lambda[i][a];
    }
    for (int j = first; j < 6; j++) {
      f->S[at][w->n + j - first] = code_now.S[fb_sym6_index(i, j)];
    }
  }
  code_write_factor(w, f, names);
  for (int a = 0; a < w->n; a++) {
    code_now.q_dot[a] = f->x[a];
  }
  for (int i = first; i < 6; i++) {
    code_now.V[i] = f->x[w->n + i - first];
  }
  if (code_lines[0].centered) {
    code_write_large_origin(w);
  }
}

/* Velocities of the frame in the axes of line k, those of its points, dT/dq; at: where q is in x and rate. */
static void code_write_large_line(const code *w, int at, int k)
{
  const fb_line *const line = &code_model.body->lines.line[k];
  const code_value u = code_variable("u_%d", k), o = code_variable("o_%d", k);
  code_sum s;
  code_template(w, "  $ ");
  fprintf(w->out, "%s[3], %s[3];\n", u.name, o.name);
  for (int i = 0; i < 6; i++) {
    code_begin(&s);
    for (int j = 0; j < 3; j++) {
      code_add_one(&s, code_large_axes(k, j, i % 3), code_now.V[i - i % 3 + j]);
    }
    code_assign(w, &s, code_plain("%s[%d]", i < 3 ? u.name : o.name, i % 3).name);
  }
  fputs("  ", w->out);
  code_write_large_call(w, "drift", k);
  fprintf(w->out, ", rate + %d, %s);\n  ", at + line->first, o.name);
  code_write_large_call(w, "gradient", k);
  fprintf(w->out, ", %s, %s", u.name, o.name);
  if (line->moves || code_lines[k].carries) {
    fprintf(w->out, ", x + %d, rate + %d", at + line->first, at + line->first);
  }
  if (code_lines[k].carries) {
    fprintf(w->out, ", %s", code_variable("held_%d", k).name);
  }
  fputs(");\n", w->out);
}

/* First moment of mass of the rest of the body, in the axes of the line. */
static void code_write_large_hub(const code *w)
{
  code_sum s;
  for (int i = 0; i < 3; i++) {
    code_write_value(w, i);
    code_hub[i] = code_now.value[i];
  }
  code_template(w, "  $ hub[3];\n");
  for (int j = 0; j < 3; j++) {
    code_begin(&s);
    for (int i = 0; i < 3; i++) {
      code_add_one(&s, code_large_axes(0, i, j), code_hub[i]);
    }
    code_assign(w, &s, code_variable("hub[%d]", j).name);
  }
}

/* Up to the rates of the coordinates, and the gradients by lines. */
static void code_write_large(const code *w)
{
  fputs("\n  /* poses and inertia of the lines (E14.1 to E14.6) */\n", w->out);
  code_write_large_poses(w, "x", 10);
  code_template(w, "  if (!sound) {\n    return @_is_finite(x + 10, %n) ? @_range : @_not_finite;\n  }\n");
  code_write_lambda(w);
  code_write_inertia(w);
  if (code_lines[0].centered) {
    code_write_large_hub(w);
  }
  code_write_large_inertias(w, "x", 10);
  fputs("\n  /* E14.12: Lambda, M_rr and first moment of mass of the whole */\n", w->out);
  code_write_large_inertia(w);
  for (int i = 0; i < code_model.first; i++) {
    code_now.V[i] = code_constant(0.0);
  }
  if (code_model.first == 6) {
    code_write_given(w);
  }
  fputs(code_lines[0].centered
            ? "\n  /* E8.13, E14.13: M q_dot + Lambda^T w = pi,  Lambda q_dot + J w = h about the mass "
              "center, by L D L^T */\n"
            : "\n  /* E8.13, E14.13: M q_dot + Lambda^T V = pi,  Lambda q_dot + M_rr V = (0, h), by "
              "L D L^T */\n",
        w->out);
  code_write_large_solve(w);
  if (code_model.first < 6) {
    code_write_names(w);
  }
  for (int a = 0; a < w->n; a++) {
    code_sum s;
    code_begin(&s);
    code_add_one(&s, 1.0, code_now.q_dot[a]);
    code_assign(w, &s, code_variable("rate[%d]", 10 + a).name);
  }
  fputs("\n  /* E14.7: dT/dq of the lines at fixed V and q_dot */\n", w->out);
  for (int k = 0; k < code_model.body->lines.n_line; k++) {
    code_write_large_line(w, 10, k);
  }
}

static int code_large_is_diagonal(double F[FB_MAX_MODES][FB_MAX_MODES], int a, int n)
{
  int only = 1;
  for (int b = 0; b < n; b++) {
    only = only && (b == a || !(fabs(F[a][b]) > 0.0));
  }
  return only;
}

/* E11.37: w[at] = bound of the largest eigenvalue of A against the inertia whose inverse is G. */
static void code_write_large_norm(const code *w, code_value G[FB_MAX_MODES][FB_MAX_MODES], const fb_sparse *from,
                                  double unit, int at)
{
  static double A[FB_MAX_MODES][FB_MAX_MODES], F[FB_MAX_MODES][FB_MAX_MODES];
  static code_value GF[FB_MAX_MODES][FB_MAX_MODES], Q[FB_MAX_MODES][FB_MAX_MODES];
  const int n = w->n;
  int diagonal = 1;
  char number[40];
  code_sum s, trace;
  code_read_sparse(A, from, n);
  if (!(unit > 0.0)) {
    fprintf(w->out, "    w[%d] = 0;\n", at);
    return;
  }
  code_root(F, A, unit, n);
  for (int a = 0; a < n; a++) {
    diagonal = diagonal && code_large_is_diagonal(F, a, n);
  }
  for (int a = 0; a < n && !diagonal; a++) {
    for (int b = 0; b < n; b++) {
      code_begin(&s);
      for (int m = 0; m < n; m++) {
        code_add_one(&s, F[m][b], G[a][m]);
      }
      GF[a][b] = code_end(w, &s, code_variable("GF%d_%d_%d", at, a, b));
    }
  }
  for (int a = 0; a < n; a++) {
    for (int b = 0; b <= a; b++) {
      code_begin(&s);
      for (int m = 0; m < n && !diagonal; m++) {
        code_add_one(&s, F[m][a], GF[m][b]);
      }
      code_add_one(&s, diagonal ? F[a][a] * F[b][b] : 0.0, G[a][b]);
      Q[a][b] = Q[b][a] = code_end(w, &s, code_variable("Q%d_%d_%d", at, a, b));
    }
  }
  code_begin(&trace);
  for (int a = 0; a < n; a++) {
    for (int b = 0; b <= a; b++) {
      code_value square;
      code_begin(&s);
      for (int m = 0; m < n; m++) {
        code_add(&s, 1.0, Q[a][m], Q[m][b]);
      }
      square = code_end(w, &s, code_variable("QQ%d_%d_%d", at, a, b));
      code_add(&trace, a == b ? 1.0 : 2.0, square, square);
    }
  }
  code_declare(w, &trace, "trace");
  code_number(number, w, unit);
  fprintf(w->out, "    w[%d] = %s * ", at, number);
  code_template(w, "sqrt~(sqrt~(trace));\n");
}

/* E11.36: G, the inverse of M - Lambda^T M_rr^-1 Lambda; from the factors L D L^T of all rows. */
static void code_write_large_mobility(const code *w, code_value G[FB_MAX_MODES][FB_MAX_MODES])
{
  static code_value P[FB_MAX_MODES][CODE_ROWS], Q[FB_MAX_MODES][CODE_ROWS];
  const code_factor *const f = &code_solver;
  code_sum s;
  for (int a = 0; a < w->n; a++) {
    for (int k = 0; k < f->n; k++) {
      code_begin(&s);
      code_add_one(&s, k == a ? 1.0 : 0.0, code_constant(1.0));
      for (int m = a; m < k; m++) {
        code_add(&s, -1.0, f->low[k][m], P[a][m]);
      }
      P[a][k] = code_end(w, &s, code_variable("P_%d_%d", a, k));
    }
    for (int k = 0; k < f->n; k++) {
      code_begin(&s);
      code_add(&s, 1.0, P[a][k], f->share[k]);
      Q[a][k] = code_end(w, &s, code_variable("PD_%d_%d", a, k));
    }
  }
  for (int a = 0; a < w->n; a++) {
    for (int b = 0; b <= a; b++) {
      code_begin(&s);
      for (int k = a; k < f->n; k++) {
        code_add(&s, 1.0, P[b][k], Q[a][k]);
      }
      G[a][b] = G[b][a] = code_end(w, &s, code_variable("G_%d_%d", a, b));
    }
  }
}

/* most = the square of the fastest rotation of a section relative to the frame, or itself (E11.37) */
static void code_write_large_fastest(const code *w, const char *most)
{
  code inner = *w;
  inner.indent = 6;
  for (int k = 0; k < code_model.body->lines.n_line; k++) {
    code_sum s;
    code_line = code_lines[k];
    code_loop(w, 4, 'j', 0, code_line.m);
    code_begin(&s);
    for (int i = 0; i < 3; i++) {
      if (code_line.w.x[i].name[0] == 'l') {
        const code_value own = code_variable("w_%c", 'x' + i);
        code_template(w, "      const $ ");
        fprintf(w->out, "%s = %s.w_%c[j] - %s[%d];\n", own.name, code_variable("line_%d", k).name, 'x' + i,
                code_variable("o_%d", k).name, i);
        code_add(&s, 1.0, own, own);
      }
    }
    code_declare(&inner, &s, "square");
    if (w->lanes) {
      fprintf(w->out, "      %s = %s_wide_either(square <= %s, %s, square);\n    }\n", most, w->name, most, most);
    } else {
      fprintf(w->out, "      %s = square <= %s ? %s : square;\n    }\n", most, most, most);
    }
  }
}

/* What a step needs beside the rates, w: velocity of O relative to the mass center, first moment of mass; step limit. */
static void code_write_large_frame(const code *w)
{
  static code_value G[FB_MAX_MODES][FB_MAX_MODES];
  const fb_body *const body = code_model.body;
  code inner = *w;
  inner.indent = 4;
  fputs("  w[3] = vx;\n  w[4] = vy;\n  w[5] = vz;\n", w->out);
  for (int i = 0; i < 3 && code_model.first < 6; i++) {
    code_sum s;
    code_begin(&s);
    code_add_one(&s, 1.0, code_now.value[i]);
    code_assign(w, &s, code_variable("w[%d]", 6 + i).name);
  }
  if (body->allow_long_step) {
    return;
  }
  fputs(
      "\n  /* E11.36, E11.37: bounds of stiffness and damping at this deflection, fastest section, for the step limit "
      "*/\n",
      w->out);
  code_template(w, "  if (w[9] > `0`) {\n");
  code_write_large_mobility(&inner, G);
  code_template(w, "    w[10] = w[11] = `0`;\n");
#if FB_WITH_DAMPING
  if (body->effects & FB_EFFECT_DAMPING) {
    fputs("    {\n", w->out);
    code_write_large_norm(&inner, G, &body->C, (double)body->limit_damping, 10);
    fputs("    }\n", w->out);
  }
#endif
  code_write_large_norm(&inner, G, &body->K, (double)body->limit_elastic, 9);
  code_write_large_fastest(w, "w[11]");
  fputs("  }\n", w->out);
}

static void code_write_rates(const code *w, int unused)
{
  (void)unused;
  code_template(w,
                "\n/* Rates of the vector x = (quat, u, h, q, pi | rho, L) under what acts (NULL: nothing); w: "
                "angular velocity; a:\n"
                "   acceleration of the mass center by the loads [m/s^2]. */\n"
                "static @_NOINLINE @_status @_rates_at(%M$ *rate, $ *w, $ *a, const $ *x, const @_input *in)\n{\n%V");
  code_template(w, code_model.first > 0 ? "  const @_input *const act = in ? in : &@_nothing;\n" : "");
  code_template(w, code_model.first > 0 || w->central ? "  $ R[9];\n" : "");
  code_write_state(w);
  code_template(w, code_model.first > 0 || w->central ? "  @_matrix(R, x);\n" : "");
  code_write_rotors(w, code_place(w, 'g'), "in", "rotor_motor");
  code_write_own_pi(w, code_now.pi);
  if (w->large) {
    code_write_large(w);
  } else {
    code_write_lambda(w);
    code_write_momenta(w);
    code_write_inertia(w);
    code_write_velocities(w);
    code_write_q_dot(w);
  }
  code_central.acts = 0;
  if (w->central) {
    code_write_attraction(w);
  }
  code_write_pi_dot(w);
  code_write_rotor_rates(w, code_place(w, 'k'), code_place(w, 'g'));
  code_write_frame(w);
  if (w->rotors > 0 || w->central) {
    char target[32];
    snprintf(target, sizeof target, "w[%d]", code_place(w, 'w') - 1);
    fputs(w->rotors > 0 ? "\n  /* E11.46 */\n" : "", w->out);
    code_write_nutation(w, target, w->central ? code_central.rate : code_constant(0.0));
  }
  if (w->large) {
    code_write_large_frame(w);
  }
  if (code_model.first == 0) {
    code_write_loads(w);
  } else {
    code_write_pull(w);
  }
}

/* ---- the rest of the step */

static const char code_status_type[] =
    "typedef enum @_status { /* values of fb_status */\n"
    "  @_ok = 0,\n  @_null = -1,        /* a pointer is NULL */\n"
    "  @_value = -2,       /* dt is not above 0 */\n"
    "  @_not_finite = -3,  /* not finite, or so large that its square is not */\n"
    "  @_step_length = -9, /* dt is longer than the stability limit, or the frame turns too far in a step */\n"
    "  @_range = -10       /* the deflection has left the range of the model */\n";

static const char code_state_type[] =
    "/* All that changes; as fb_state. Kahan terms lost_.. are zero when a state is written. */\n"
    "typedef struct @_state {\n"
    "  $ rho[3];  /* [m] position of O, inertial axes */\n"
    "  $ quat[4]; /* attitude of the body frame, w x y z */\n"
    "  $ u[3];    /* [m/s] velocity, inertial axes: of the mass center; prescribed base: of O; pinned: zero */\n"
    "  $ L[3];    /* [N m s] angular momentum, inertial axes: about the mass center; pinned: about O; prescribed: zero "
    "*/\n"
    "  $ q[%m], pi[%m]; /* coordinates and conjugate momenta of the modes */\n"
    "  $ lost_rho[3], lost_u[3];\n";

static const char code_types_single[] = "  $ lost_quat[4], lost_L[3], lost_h[3], lost_q[%m], lost_pi[%m];\n";

static const char code_types_rotors[] = "  $ rotor_angle[%R], rotor_momentum[%R]; /* [rad] relative to the node, [N m "
                                        "s]; L and pi contain the momenta */\n";

static const char code_types_rotors_single[] = "  $ lost_rotor_angle[%R], lost_rotor_momentum[%R];\n";

static const char code_input_rotors[] =
    "  $ rotor_motor[%R]; /* [N m] on each rotor, and reversed on the body; where given: its momentum [N m s] */\n";

static const char code_types_end[] =
    "} @_state;\n\n"
    "typedef struct @_input { /* what acts at one instant; all zero, or NULL: nothing */\n";

static const char code_input_of[3][200] = {
    "  $ force[3], torque[3]; /* [N], [N m] at O, body axes */\n",
    "  $ torque[3]; /* [N m] on the body, body axes */\n",
    "  $ v[3], w[3], v_dot[3]; /* [m/s], [rad/s], [m/s^2] of the base, body axes; v_dot for the limit */\n"};

static const char code_input_end[] =
    "  $ gravity[3];          /* [m/s^2] uniform, inertial axes, beside that of the description */\n"
    "  $ modal[%m];            /* generalized forces of the coordinates */\n";

static const char code_declarations[] =
    "/* At the inertial origin, at rest, undeformed. */\n"
    "void @_start(@_state *state);\n"
    "/* One step of classical Runge-Kutta, dt [s], under what acts at its start, middle and end. Refused: the state "
    "stays as\n"
    "   it was. */\n"
    "@_status @_step(%M@_state *state, const @_input *start, const @_input *middle, const @_input *end, $ dt);\n";

static const char code_helpers[] =
    "/* Short loops are unrolled, which -O2 does not by itself; the rates keep the registers to themselves. */\n"
    "#if defined(__clang__)\n#define @_UNROLL _Pragma(\"unroll 8\")\n"
    "#elif defined(__GNUC__)\n#define @_UNROLL _Pragma(\"GCC unroll 8\")\n#else\n#define @_UNROLL\n#endif\n"
    "#if defined(__GNUC__)\n#define @_NOINLINE __attribute__((noinline))\n#else\n#define @_NOINLINE\n#endif\n\n";

static const char code_restrict[] =
    "/* fields of the lines do not overlap, and begin at multiples of two numbers */\n"
    "#if defined(__GNUC__)\n#define @_RESTRICT __restrict\n#define @_ALIGNED __attribute__((aligned(16)))\n"
    "#else\n#define @_RESTRICT\n#define @_ALIGNED\n#endif\n\n";

static const char code_finite[] = "static int @_is_finite(const $ *x, int n)\n{\n"
                                  "  $ sum = %z;\n"
                                  "  for (int i = 0; i < n; i++) {\n    sum += fabs~(x[i]);\n  }\n"
                                  "  return %(sum <= @_huge%);\n}\n\n"
                                  "static int @_input_is_finite(const @_input *in)\n{\n"
                                  "  return !in || (@_is_finite(in->gravity, 3) && @_is_finite(in->modal, %n)";

static const char code_input_finite[3][120] = {
    " &&\n                 @_is_finite(in->force, 3) && @_is_finite(in->torque, 3)", " && @_is_finite(in->torque, 3)",
    ""};

static const char code_matrix[] =
    "/* E4.1: rotation matrix of a quaternion of any length */\n"
    "static void @_matrix($ *R, const $ *q)\n{\n"
    "  const $ two = `2` / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);\n"
    "  const $ x2 = two * q[1], y2 = two * q[2], z2 = two * q[3];\n"
    "  const $ wx = q[0] * x2, wy = q[0] * y2, wz = q[0] * z2, xx = q[1] * x2, xy = q[1] * y2, xz = q[1] * z2;\n"
    "  const $ yy = q[2] * y2, yz = q[2] * z2, zz = q[3] * z2;\n"
    "  R[0] = `1` - (yy + zz);\n  R[1] = xy - wz;\n  R[2] = xz + wy;\n"
    "  R[3] = xy + wz;\n  R[4] = `1` - (xx + zz);\n  R[5] = yz - wx;\n"
    "  R[6] = xz - wy;\n  R[7] = yz + wx;\n  R[8] = `1` - (xx + yy);\n}\n\n";

static const char code_turn[] =
    "/* y = R x by the quaternion of R */\n"
    "static void @_turn($ *y, const $ *q, const $ *x)\n{\n"
    "  const $ two = `2` / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);\n"
    "  const $ t0 = q[2] * x[2] - q[3] * x[1], t1 = q[3] * x[0] - q[1] * x[2], t2 = q[1] * x[1] - q[2] * x[0];\n"
    "  y[0] = x[0] + two * (q[0] * t0 + q[2] * t2 - q[3] * t1);\n"
    "  y[1] = x[1] + two * (q[0] * t1 + q[3] * t0 - q[1] * t2);\n"
    "  y[2] = x[2] + two * (q[0] * t2 + q[1] * t1 - q[2] * t0);\n}\n";

static const char code_turn_back[] = "\n/* y = R^T x */\n"
                                     "static void @_turn_back($ *y, const $ *q, const $ *x)\n{\n"
                                     "  const $ back[4] = {q[0], -q[1], -q[2], -q[3]};\n"
                                     "  @_turn(y, back, x);\n}\n";

static const char code_norm[] = "\nstatic $ @_norm(const $ *x)\n{\n"
                                "  return sqrt~(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);\n}\n";

/* The input that is meant by NULL. */
static void code_write_nothing(const code *w)
{
  const int n = (code_model.first == 3 ? 2 : 4); /* vectors */
  if (w->lanes) {
    code_template(w, "\nstatic @_input @_nothing;\n");
    return;
  }
  code_template(w, "\nstatic const @_input @_nothing = {");
  for (int k = 0; k < n; k++) {
    code_template(w, "{`0`, `0`, `0`}, ");
  }
  for (int a = 0; a < code_place(w, 'm'); a++) {
    code_template(w, a == 0 ? "{`0`" : ", `0`");
  }
  fputs("}", w->out);
  for (int r = 0; r < w->rotors; r++) {
    code_template(w, r == 0 ? ", {`0`" : ", `0`");
  }
  fputs(w->rotors > 0 ? "}" : "", w->out);
  for (int k = 0; k < FB_MAX_NODES; k++) {
    code_template(w, code_loads.at[k] ? ", {`0`, `0`, `0`}, {`0`, `0`, `0`}" : "");
  }
  fputs("};\n", w->out);
}

/* c(q), first moment of mass. */
static void code_write_center(const code *w)
{
  code_template(w, w->large
                       ? "\n/* E8.16: c(q) [kg m], first moment of mass, body axes; 0 where a line turns too far */\n"
                         "static int @_center(%M$ *c, const $ *q)\n{\n%V"
                       : "\n/* E8.16: c(q) [kg m], first moment of mass, body axes */\n"
                         "static void @_center(%M$ *c, const $ *q)\n{\n%V");
  if (w->large) {
    code_write_large_poses(w, "q", 0);
  }
  for (int i = 0; i < 3; i++) {
    const code_poly *const p = &code_model.poly[i];
    code_sum s;
    char target[32];
    code_value slope[FB_MAX_MODES];
    for (int b = 0; b < w->n; b++) {
      code_begin(&s);
      code_add_one(&s, p->linear[b], code_constant(1.0));
      for (int a = 0; a < w->n; a++) {
        code_add_one(&s, 0.5 * p->square[b][a], code_variable("q[%d]", a));
      }
      slope[b] = code_end(w, &s, code_variable("c_%c_%d", 'x' + i, b));
    }
    code_begin(&s);
    code_vary_add(&s, p->constant, p->hub);
    for (int b = 0; b < w->n; b++) {
      code_add(&s, 1.0, slope[b], code_variable("q[%d]", b));
    }
    for (int k = 0; k < code_model.body->lines.n_line && w->large; k++) {
      code_add_one(&s, 1.0, code_write_large_center(w, "q", 0, k, i));
    }
    snprintf(target, sizeof target, "c[%d]", i);
    code_assign(w, &s, target);
  }
  fputs(w->large ? "  return sound;\n" : "", w->out);
  if (w->n == 0) {
    fputs("  (void)q;\n", w->out);
  }
  fputs("}\n", w->out);
}

/* Longest step: E8.8, E11.1. */
static void code_write_limit(const code *w)
{
  const fb_body *const body = code_model.body;
  const double c = sqrt((double)(body->c[0] * body->c[0] + body->c[1] * body->c[1] + body->c[2] * body->c[2]));
  const int more = w->rotors > 0 || w->central;
  const code_value whole = code_variable("%s", w->large || more ? "whole" : "spin");
  code_sum s;
  code_template(w, "\n/* E8.8, E11.1: longest stable step [s] at angular velocity w and acceleration by loads a */\n"
                   "static $ %*@_longest(%Mconst $ *w, $ %*a)\n{\n%V"
                   "  const $ spin = @_norm(w);\n");
  if (w->large || more) {
    code_template(w, "  const $ whole = spin");
    code_template(w, w->large ? " + sqrt~(w[11])" : "");
    if (more) {
      fprintf(w->out, " + w[%d]", code_place(w, 'w') - 1);
    }
    code_template(w, w->large     ? "; /* that of the fastest section (E11.37) */\n"
                     : w->central ? "; /* and by the gradient of gravity (E8.37), nutation by rotors (E11.46) */\n"
                                  : "; /* nutation by rotors (E11.46) */\n");
  }
  code_begin(&s);
  if (code_model.first == 0) {
    if (w->vary & CODE_HUB) {
      code_template(w, "  const $ fling = model->arm * spin * spin;\n");
      code_add_one(&s, 1.0, code_variable("fling"));
    } else {
      code_add(&s, c / (double)body->mass, code_variable("spin"), code_variable("spin"));
    }
  }
  code_add_one(&s, 1.0, code_variable(w->lanes ? "*a" : "a"));
  code_declare(w, &s, "acceleration");
  code_begin(&s);
  if (w->large) {
    code_add(&s, 0.5, code_variable("w[10]"), code_factor_of(w, CODE_DAMPED, "damping"));
  } else {
    code_add(&s, (double)body->limit_damping, code_factor_of(w, CODE_DAMPED | CODE_HUB, "most_damping"),
             code_constant(0.5));
  }
  code_add_one(&s, 1.0, whole);
  code_declare(w, &s, "g");
  code_begin(&s);
  if (w->large) {
    code_add(&s, 1.0, code_variable("w[9]"), code_factor_of(w, CODE_STIFFNESS, "stiffness"));
  } else {
    code_add_one(&s, (double)body->limit_elastic, code_factor_of(w, CODE_STIFFNESS | CODE_HUB, "most_stiffness"));
  }
  if (w->vary & CODE_HUB) {
    code_template(w, "  const $ spread = model->stiffening * spin * spin, pull = model->stiffening * acceleration;\n");
    code_add_one(&s, (double)body->limit_spin, code_variable("spread"));
    code_add_one(&s, (double)body->limit_acceleration, code_variable("pull"));
  } else {
    code_add(&s, (double)body->limit_spin, whole, whole);
    code_add_one(&s, (double)body->limit_acceleration, code_variable("acceleration"));
  }
  code_declare(w, &s, "k");
  code_template(w, "  const $ bound = g + sqrt~(g * g + k);\n");
  if (!((double)body->limit_acceleration > 0.0)) {
    fputs("  (void)acceleration;\n", w->out);
  }
  if (w->vary & CODE_HUB) {
    fputs("  (void)spread, (void)pull;\n", w->out);
  }
  code_template(w, w->lanes ? "  *a = `2.785` / bound;\n  return a;\n}\n"
                            : "  if (!(bound >= `0`)) {\n    return `0`;\n  }\n"
                              "  return bound * @_huge > `2.785` ? `2.785` / bound : @_huge;\n}\n");
}

static const char code_sums[] = "\n/* E11.22: Kahan sum; d becomes x + d, lost what rounding took */\n"
                                "static void @_sum_kept($ *d, $ *lost, const $ *x, int n)\n{\n"
                                "  @_UNROLL\n  for (int i = 0; i < n; i++) {\n"
                                "    const $ more = d[i] + lost[i];\n"
                                "    d[i] = x[i] + more;\n"
                                "    lost[i] = more - (d[i] - x[i]);\n  }\n}\n";

static const char code_unit[] =
    "\n/* The increment d of the attitude so that it has unit length */\n"
    "static @_status @_unit($ *d, const $ *x)\n{\n"
    "  $ quat[4], norm2 = %z, norm;\n"
    "  for (int i = 0; i < 4; i++) {\n    quat[i] = x[i] + d[i];\n    norm2 += quat[i] * quat[i];\n  }\n"
    "  if (!(%(norm2 > `1e-20`%) && %(norm2 < @_huge%))) {\n    return @_not_finite;\n  }\n"
    "  norm = sqrt~(norm2);\n"
    "  for (int i = 0; i < 4; i++) {\n    d[i] += (`1` - norm2) / (norm * (`1` + norm)) * quat[i];\n  }\n"
    "  return @_ok;\n}\n";

static const char code_align[] =
    "\n/* E11.29: the increment d of the attitude so that R h is along L */\n"
    "static void @_align($ *d, const $ *x)\n{\n"
    "%K  $ quat[4], h[3], b[3], r[3], theta[3], sizes, told;\n"
    "  const $ change = @_norm(d + %l);\n"
    "  for (int i = 0; i < 4; i++) {\n    quat[i] = x[i] + d[i];\n  }\n"
    "  for (int i = 0; i < 3; i++) {\n    h[i] = x[7 + i] + d[7 + i];\n    b[i] = x[%l + i] + d[%l + i];\n  }\n"
    "  @_turn(r, quat, h);\n"
    "  sizes = @_norm(r) * @_norm(b);\n"
    "  theta[0] = r[1] * b[2] - r[2] * b[1];\n"
    "  theta[1] = r[2] * b[0] - r[0] * b[2];\n"
    "  theta[2] = r[0] * b[1] - r[1] * b[0];\n"
    "  told = %Tsizes > change * change%t;\n";

static const char code_align_single[] = "  told *= %T@_norm(theta) >= `16` * `1.19209290e-7` * sizes%t;\n";

static const char code_align_end[] =
    "  for (int i = 0; i < 3; i++) {\n    theta[i] *= `0.5` * told / (sizes + (`1` - told));\n  }\n"
    "  d[0] -= theta[0] * quat[1] + theta[1] * quat[2] + theta[2] * quat[3];\n"
    "  d[1] += theta[0] * quat[0] + theta[1] * quat[3] - theta[2] * quat[2];\n"
    "  d[2] += theta[1] * quat[0] + theta[2] * quat[1] - theta[0] * quat[3];\n"
    "  d[3] += theta[2] * quat[0] + theta[0] * quat[2] - theta[1] * quat[1];\n"
    "}\n";

/* The check after a step. */
static void code_write_range(const code *w)
{
  char number[40];
  code_sum s;
  code_begin(&s);
  for (int a = 0; a < w->n; a++) {
    code_add_one(&s, (double)code_model.body->reach[a],
                 w->lanes ? code_variable("size_%d", a) : code_variable("fabs%s(d[%d])", w->single ? "f" : "", 10 + a));
  }
  code_template(w, "\n/* What fb_rk4_step checks of the state d after a step: finite, deflection [m] by bounds of the "
                   "modes, length of the\n"
                   "   quaternion */\n"
                   "static @_status @_check(const $ *d)\n{\n"
                   "  const $ norm2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + d[3] * d[3];\n"
                   "  $ sum = %z;\n  @_UNROLL\n"
                   "  for (int i = 0; i < %N; i++) {\n    sum += fabs~(d[i]);\n  }\n"
                   "  if (!(%(sum <= @_huge%))) {\n    return @_not_finite;\n  }\n");
  for (int a = 0; a < w->n && w->lanes; a++) {
    code_template(w, "  const $ ");
    fprintf(w->out, "size_%d = %s_wide_abs(d[%d]);\n", a, w->name, 10 + a);
  }
  code_declare(w, &s, "deflection");
  code_number(number, w, (double)code_model.body->deflection_limit);
  code_template(w, "  if (!(%(deflection <= ");
  fputs(number, w->out);
  code_template(w, "%))) {\n    return @_range;\n  }\n"
                   "  return %(fabs~(norm2 - `1`) <= `2e-3`%) ? @_ok : @_step_length;\n}\n");
}

static const char code_enter[] = "\n/* The vector x of a state, with h = R^T L. */\n"
                                 "static void @_enter(%M$ *x, const @_state *s)\n{\n%V"
                                 "  memcpy(x, s->quat, sizeof s->quat);\n"
                                 "  memcpy(x + 4, s->u, sizeof s->u);\n"
                                 "  @_turn_back(x + 7, s->quat, s->L);\n"
                                 "  memcpy(x + %r, s->rho, sizeof s->rho);\n"
                                 "  memcpy(x + %l, s->L, sizeof s->L);\n";

static const char code_enter_modes[] = "  memcpy(x + 10, s->q, sizeof s->q);\n"
                                       "  memcpy(x + %p, s->pi, sizeof s->pi);\n";

static const char code_enter_rotors[] = "  memcpy(x + %k, s->rotor_angle, sizeof s->rotor_angle);\n"
                                        "  memcpy(x + %g, s->rotor_momentum, sizeof s->rotor_momentum);\n";

static const char code_enter_single[] = "  for (int i = 0; i < 3; i++) {\n    x[7 + i] += s->lost_h[i];\n  }\n";

static const char code_enter_mass[] = "  for (int i = 0; i < 3; i++) { /* by the factor of the mass */\n"
                                      "    x[7 + i] *= model->share;\n    x[%l + i] *= model->share;\n  }\n"
                                      "  for (int a = %p; a < %r; a++) {\n    x[a] *= model->share;\n  }\n";

static const char code_keep_single[] =
    "\n/* What rounding takes from h = R^T L, across it: much spin about an axis of little inertia. more: increment of "
    "h */\n"
    "static void @_keep(@_state *next, const @_state *from, const $ *more)\n{\n"
    "  $ before[3], after[3], size, along = %z;\n"
    "  @_turn_back(before, from->quat, from->L);\n"
    "  @_turn_back(after, next->quat, next->L);\n"
    "  size = after[0] * after[0] + after[1] * after[1] + after[2] * after[2];\n"
    "  for (int i = 0; i < 3; i++) {\n"
    "    next->lost_h[i] = %Wsize > `0`%,from->lost_h[i] + ((before[i] - after[i]) + more[i])%!;\n"
    "    along += next->lost_h[i] * after[i];\n  }\n"
    "  for (int i = 0; i < 3; i++) {\n"
    "    next->lost_h[i] -= %Wsize > `0`%,along / size * after[i]%!;\n  }\n}\n";

static const char code_end_declare[] = "  $ lost_u[3], lost_rho[3];\n"
                                       "  memcpy(lost_u, state->lost_u, sizeof lost_u);\n"
                                       "  memcpy(lost_rho, state->lost_rho, sizeof lost_rho);\n";

static const char code_end_declare_single[] = "  @_state next = *state;\n"
                                              "  $ *const lost_u = next.lost_u, *const lost_rho = next.lost_rho;\n";

static const char code_end_pin[] =
    "  for (int i = 0; i < 3; i++) { /* the pin rests */\n"
    "    status = status == @_ok && !(%(fabs~(state->u[i]) + fabs~(state->lost_u[i]) <= `0`%)) ? @_value : status;\n"
    "  }\n";

/* Momenta keep their bits: their increments alone are scaled. */
static const char code_end_mass[] = "  for (int i = 0; i < 3; i++) {\n    d[%l + i] *= model->mass;\n  }\n"
                                    "  for (int a = %p; a < %r; a++) {\n    d[a] *= model->mass;\n  }\n"
                                    "  memcpy(x + %l, state->L, sizeof state->L);\n";

static const char code_end_mass_single[] = "  for (int i = 0; i < 3; i++) {\n    d[7 + i] *= model->mass;\n  }\n";

static const char code_end_mass_modes[] = "  memcpy(x + %p, state->pi, sizeof state->pi);\n";

static const char code_end_double[] = "  for (int i = 0; i < 4; i++) {\n    d[i] += x[i];\n  }\n"
                                      "  @_UNROLL\n  for (int a = 10; a < %r; a++) {\n    d[a] += x[a];\n"
                                      "    d[a] = %Ffabs~(d[a]) < @_tiny%:d[a]%;;\n  }\n"
                                      "  for (int i = %l; i < %N; i++) {\n    d[i] += x[i];\n  }\n";

static const char code_end_single[] =
    "  @_sum_kept(d, next.lost_quat, x, 4);\n"
    "  @_sum_kept(d + 10, next.lost_q, x + 10, %n);\n"
    "  @_sum_kept(d + %p, next.lost_pi, x + %p, %n);\n"
    "  @_sum_kept(d + %l, next.lost_L, x + %l, 3);\n"
    "  for (int a = 10; a < %r; a++) {\n    d[a] = %Ffabs~(d[a]) < @_tiny%:d[a]%;;\n  }\n";

static const char code_end_rotors_single[] = "  @_sum_kept(d + %k, next.lost_rotor_angle, x + %k, %R);\n"
                                             "  @_sum_kept(d + %g, next.lost_rotor_momentum, x + %g, %R);\n";

static const char code_end_settle[] = "  for (int r = 0; r < %R; r++) {\n    @_settle(&d[%k + r]);\n  }\n";

static const char code_end_rotors[] = "  memcpy(state->rotor_angle, d + %k, sizeof state->rotor_angle);\n"
                                      "  memcpy(state->rotor_momentum, d + %g, sizeof state->rotor_momentum);\n";

static const char code_end_rest[] = "  @_sum_kept(d + 4, lost_u, x + 4, 3);\n"
                                    "  for (int i = 0; i < 3; i++) {\n"
                                    "    d[4 + i] = %Ffabs~(d[4 + i]) < @_faint%:d[4 + i]%;;\n"
                                    "    d[%l + i] = %Ffabs~(d[%l + i]) < @_faint%:d[%l + i]%;;\n  }\n";

static const char code_end_keep_single[] = "  memcpy(next.quat, d, sizeof next.quat);\n"
                                           "  memcpy(next.L, d + %l, sizeof next.L);\n"
                                           "  @_keep(&next, state, d + 7);\n";

static const char code_end_position[] = "\n  /* E11.30: O from the mass center */\n"
                                        "  @_center(%Abefore, x + 10);\n"
                                        "  @_center(%Aafter, d + 10);\n"
                                        "  @_turn(old, x, before);\n"
                                        "  @_turn(own, d, after);\n";

static const char code_end_large_position[] = "\n  /* E11.30: O from the mass center; range of the lines */\n"
                                              "  sound = @_center(%Aafter, d + 10);\n"
                                              "  @_turn(old, x, before);\n"
                                              "  @_turn(own, d, after);\n";

static const char code_end_check[] = "  @_sum_kept(d + %r, lost_rho, x + %r, 3);\n"
                                     "  status = status == @_ok ? @_check(d) : status;\n";

static const char code_end_commit[] = "  if (status != @_ok) {\n    return status;\n  }\n";

static const char code_end_take[] = "  memcpy(state->rho, d + %r, sizeof state->rho);\n"
                                    "  memcpy(state->quat, d, sizeof state->quat);\n"
                                    "  memcpy(state->u, d + 4, sizeof state->u);\n"
                                    "  memcpy(state->L, d + %l, sizeof state->L);\n"
                                    "  memcpy(state->lost_rho, lost_rho, sizeof state->lost_rho);\n"
                                    "  memcpy(state->lost_u, lost_u, sizeof state->lost_u);\n";

static const char code_end_modes[] = "  memcpy(state->q, d + 10, sizeof state->q);\n"
                                     "  memcpy(state->pi, d + %p, sizeof state->pi);\n";

/* E11.31: pi relative to the velocity v of the base at the end of the step, u that velocity. */
static void code_write_follow(const code *w, int unused)
{
  code_sum s;
  (void)unused;
  code_template(w, "\n/* E11.31, E8.35: u becomes the velocity of the base, v in body axes; pi relative to it */\n"
                   "static ");
  code_template(w, w->large ? "int" : "void");
  code_template(w, " @_follow($ *d, const $ *x, const $ *v)\n{\n"
                   "  $ quat[4], q[%m], u[3], s[3];\n"
                   "  for (int i = 0; i < 4; i++) {\n    quat[i] = x[i] + d[i];\n  }\n"
                   "  for (int k = 0; k < %n; k++) {\n    q[k] = x[10 + k] + d[10 + k];\n  }\n"
                   "  @_turn(u, quat, v);\n"
                   "  for (int i = 0; i < 3; i++) {\n    u[i] -= x[4 + i];\n    d[4 + i] = u[i];\n  }\n"
                   "  @_turn_back(s, quat, u);\n");
  if (w->large) {
    code_write_large_poses(w, "q", 0);
    code_write_large_inertias(w, "q", 0);
  }
  for (int b = 0; b < w->n; b++) {
    char target[32];
    code_value slope[3];
    for (int i = 0; i < 3; i++) {
      code_begin(&s);
      code_add_one(&s, code_model.lambda[i].constant[b], code_constant(1.0));
      for (int a = 0; a < w->n; a++) {
        code_add_one(&s, code_model.lambda[i].slope[b][a], code_variable("q[%d]", a));
      }
      for (int k = 0; k < code_model.body->lines.n_line && w->large; k++) {
        code_large_add(&s, k, 'P', i, b);
      }
      slope[i] = code_end(w, &s, code_variable("L_%s_%d", code_rows[i], b));
    }
    code_begin(&s);
    snprintf(target, sizeof target, "d[%d]", 10 + w->n + b);
    code_add_one(&s, 1.0, code_variable("%s", target));
    for (int i = 0; i < 3; i++) {
      code_add(&s, -1.0, slope[i], code_variable("s[%d]", i));
    }
    code_assign(w, &s, target);
  }
  fputs(w->large ? "  return sound;\n}\n" : "  (void)q, (void)s;\n}\n", w->out);
}

/* Does the end of a step depend on what acts then? */
static int code_takes_last(void)
{
  return code_model.first == 6 || code_rotors_given(code_model.body);
}

/* Angles of rotors within half a turn, momenta that are given as the input has them. */
static void code_write_end_rotors(const code *w)
{
  code_template(w, w->rotors > 0 ? code_end_settle : "");
  for (int r = 0; r < w->rotors; r++) {
    if (code_model.body->rotor[r].given) {
      fprintf(w->out, "  d[%d] = last ? last->rotor_motor[%d] : ", code_place(w, 'g') + r, r);
      code_template(w, "%z;\n");
    }
  }
}

/* The end of a step. */
static void code_write_end(const code *w)
{
  char number[40];
  code_template(w, "\n/* The end of the step, from x by the increments d: the state, if it passes the checks. */\n"
                   "static @_status @_end(%M@_state *state, $ *d, %X$ *x");
  code_template(w, code_model.first == 0 && w->large ? ", const $ *before" : "");
  code_template(w, code_takes_last() ? ", const @_input *last)\n{\n%V  @_status status;\n"
                                     : ")\n{\n%V  @_status status;\n");
  code_template(w, w->large && code_model.first < 6 ? "  $ after[3];\n" : "");
  code_template(w, code_model.first != 0 ? ""
                   : w->large            ? "  $ old[3], own[3];\n"
                                         : "  $ before[3], after[3], old[3], own[3];\n");
  code_template(w, w->large ? "  int sound = 1;\n" : "");
  code_template(w, w->single ? code_end_declare_single : code_end_declare);
  code_template(w, code_model.first < 6 ? "  @_align(d, x);\n  status = @_unit(d, x);\n"
                   : w->large ? "  status = @_unit(d, x);\n  sound = @_follow(d, x, last ? last->v : @_nothing.v);\n"
                              : "  status = @_unit(d, x);\n  @_follow(d, x, last ? last->v : @_nothing.v);\n");
  code_template(w, w->vary & CODE_MASS ? code_end_mass : "");
  code_template(w, w->vary & CODE_MASS && w->n > 0 ? code_end_mass_modes : "");
  code_template_of(w, 1, w->vary & CODE_MASS ? code_end_mass_single : "");
  code_template_of(w, 1, w->rotors > 0 ? code_end_rotors_single : "");
  code_template(w, w->single ? code_end_single : code_end_double);
  code_template(w, code_end_rest);
  if (code_model.first < 6) {
    code_template_of(w, 1, code_end_keep_single);
  }
  if (code_model.first == 3 && w->large) {
    code_template(w, "  sound = @_center(%Aafter, d + 10);\n");
  }
  if (code_model.first == 0) {
    code_template(w, w->large ? code_end_large_position : code_end_position);
    code_inverse_mass(number, w);
    code_template(w, "  for (int i = 0; i < 3; i++) {\n");
    fprintf(w->out, "    d[%d + i] += %s * (old[i] - own[i]);\n  }\n", code_place(w, 'r'), number);
  }
  code_template(w, code_model.first == 3 ? code_end_pin : "");
  code_template(w, code_end_check);
  code_template(w, w->large ? "  status = status == @_ok && !sound ? @_range : status;\n" : "");
  code_template(w, code_end_commit);
  code_write_end_rotors(w);
  code_template_of(w, 1, "  *state = next;\n");
  code_template(w, code_end_take);
  if (w->n > 0) {
    code_template(w, code_end_modes);
  }
  code_template(w, w->rotors > 0 ? code_end_rotors : "");
  fputs("  return status;\n}\n", w->out);
}

static const char code_step_head[] =
    "\n/* E11.3 */\n"
    "%S@_status @_step(%M@_state *state, const @_input *start, const @_input *middle, const @_input *end, %s dt)\n{\n"
    "  static const %s node[4] = {`0.5`, `0.5`, `1`, `1`};\n"
    "  static const %s weight[4] = {`1` / `6`, `1` / `3`, `1` / `3`, `1` / `6`};\n"
    "  const @_input *in[4];\n"
    "  $ x[%N], at[%N], rate[%N], sum[%N]%Z, w[%w], first[3], a;\n";

static const char code_step_begin[] = "  if (!state%Q) {\n    return @_null;\n  }\n"
                                      "  if (!(dt > `0` && dt < @_huge)) {\n    return @_value;\n  }\n"
                                      "  in[0] = start;\n  in[1] = in[2] = middle;\n  in[3] = end;\n"
                                      "  @_enter(%Ax, state);\n"
                                      "  memcpy(at, x, sizeof at);\n%0";

static const char code_step_stages[] = "  for (int stage = 0; stage < 4; stage++) {\n"
                                       "    const %s by = dt * weight[stage], to = dt * node[stage];\n";

static const char code_step_call[] =
    "    @_status status = @_input_is_finite(in[stage]) ? @_rates_at(%Arate, w, &a, at, in[stage]) : @_not_finite;\n";

static const char code_step_limits[] =
    "\n    /* E11.1, E11.26: step limit at the start, rotation at the last stage */\n"
    "    if (status == @_ok && stage == 0) {\n"
    "      status = %(dt <= %*@_longest(%Aw, %&a)%) ? @_ok : @_step_length;\n"
    "      memcpy(first, w, sizeof first);\n    }\n"
    "    if (status == @_ok && stage == 3) {\n"
    "      for (int i = 0; i < 3; i++) {\n        first[i] = dt * (w[i] - first[i]);\n      }\n"
    "      status = %(first[0] * first[0] + first[1] * first[1] + first[2] * first[2] <= `0.25`%) ? @_ok : "
    "@_step_length;\n    }\n";

static const char code_step_rest[] =
    "    if (status != @_ok) {\n      return status;\n    }\n    @_UNROLL\n"
    "    for (int i = 0; i < %N; i++) {\n      sum[i] += by * rate[i];\n    }\n"
    "    if (stage < 3) {\n      @_UNROLL\n"
    "      for (int i = 0; i < %r; i++) {\n        at[i] = x[i] + to * rate[i];\n      }\n";

static const char code_step_end[] = "    }\n"
                                    "  }\n"
                                    "  return @_end(%Astate, sum, x";

/* Rates depend on the place, too. */
static const char code_step_place[] =
    "      for (int i = 0; i < 3; i++) {\n        at[%r + i] = place[i] + to * rate[%r + i];\n      }\n";

static const char code_start[] = "\nvoid @_start(@_state *state)\n{\n"
                                 "  memset(state, 0, sizeof *state);\n"
                                 "  state->quat[0] = `1`;\n}\n";

/* State and input. */
static void code_write_types(const code *w)
{
  code_template(w, code_state_type);
  code_template_of(w, 1, code_types_single);
  code_template(w, w->rotors > 0 ? code_types_rotors : "");
  code_template_of(w, 1, w->rotors > 0 ? code_types_rotors_single : "");
  code_template(w, code_types_end);
  code_template(w, code_input_of[code_model.first / 3]);
  code_template(w, w->traced ? "" : code_input_end);
  code_template(w, w->rotors > 0 ? code_input_rotors : "");
  code_write_load_types(w);
  code_template(w, "} @_input;\n\n");
}

/* And, where parameters vary, the model. */
static void code_write_all_types(const code *w)
{
  code_write_types(w);
  code_write_model_type(w);
}

/* Comment and declarations. */
static void code_write_head(const code *w, const fb_body *body, const char *source, int lanes,
                            void (*coordinate)(FILE *, int))
{
  static const char *const bases[FB_BASE_COUNT] = {"free", "prescribed", "pinned", "hinged"};
  const unsigned crc = fbi_body_crc(body, w->single);
  fprintf(w->out, "/* %s - made by reduce --code from ", w->name);
  output_source(w->out, source);
  fprintf(w->out,
          " with flexbeam %s, %s precision, model 0x%08X: a body\n"
          "   of %d modes on a %s base and its step of rk4, by the equations of fb_rk4_step (E8.9: "
          "tests/reference/THEORY.md). "
          "Include it where\n"
          "   needed; one file defines %s_IMPLEMENTATION before. SI units, radians.\n   Mass %.6g kg.",
          FB_VERSION, w->single ? "single" : "double", crc, w->n, bases[(int)body->base], w->name, (double)body->mass);
  for (int a = 0; a < w->n; a++) {
    fprintf(w->out, "\n   q[%d]: ", a);
    coordinate(w->out, a);
  }
  for (int r = 0; r < w->rotors; r++) {
    const fb_rotor *const rotor = &body->rotor[r];
    fprintf(w->out, "\n   rotor %d: about %.6g %.6g %.6g, %.6g kg m^2%s", r, (double)rotor->axis[0],
            (double)rotor->axis[1], (double)rotor->axis[2], (double)rotor->inertia,
            rotor->given ? ", its momentum given" : "");
  }
  fprintf(w->out, " */\n#ifndef %s_CODE\n#define %s_CODE\n#define %s_crc 0x%08Xu\n", w->name, w->name, w->name, crc);
  fputs("#ifdef __cplusplus\nextern \"C\" {\n#endif\n", w->out);
  code_template(w, code_status_type);
  code_template(w, w->traced ? "  , @_singular = -5   /* inertia that is not above zero */\n" : "");
  code_template(w, "} @_status;\n\n");
  code_write_types(w);
  if (w->vary) {
    code_write_parameters(w);
    code_write_model_type(w);
    code_template(w, code_vary_declaration);
  }
  code_template(w, code_declarations);
  code_template(w, code_read_types);
  code_template(w, w->rotors > 0 ? "  $ rotor_speed[%R]; /* [rad/s] relative to the node */\n" : "");
  code_template(w, "} @_motion;\n\n");
  code_template(w, code_node_type);
  code_template(w, code_read_types_end);
  if (code_model.first < 6) {
    code_template(w, "\n");
    code_template(w, code_energy_type);
    code_template(w, code_energy_declaration);
  }
  if (lanes) {
    code lane = *w;
    lane.lanes = CODE_LANES;
    code_lanes_template(w, code_lanes_width);
    code_write_all_types(&lane);
    code_lanes_template(w, code_lanes_declarations);
  }
  fputs("#ifdef __cplusplus\n}\n#endif\n#endif\n", w->out);
}

/* The functions of a step, of one body or of all lanes. 0: there is no temporary file, see errno. */
static int code_write_functions(const code *w)
{
  int good = 1;
  code_template(w, code_finite);
  code_template(w, code_input_finite[code_model.first / 3]);
  code_template(w, w->rotors > 0 ? " &&\n                 @_is_finite(in->rotor_motor, %R)" : "");
  code_write_of_loads(w, " &&\n                 @(in->force_#, 3) && @(in->torque_#, 3)");
  fputs(");\n}\n\n", w->out);
  code_template(w, code_matrix);
  code_template(w, code_turn);
  code_template(w, code_turn_back);
  code_template(w, w->lanes ? "" : code_norm);
  if (code_model.first > 0) {
    code_write_nothing(w);
  }
  if (w->large) {
    good = code_write_lines(w);
  }
  if (code_model.first == 0 || (code_model.first == 3 && !w->lanes)) {
    code_write_center(w);
  }
  if (w->central && code_model.first == 0) {
    code_write_lead(w);
  }
  good = code_write_pruned(w, code_write_rates, 0) && good;
  code_write_limit(w);
  code_template(w, code_sums);
  code_template(w, code_unit);
  if (code_model.first < 6) {
    code_template(w, code_align);
    code_template_of(w, 1, code_align_single);
    code_template(w, code_align_end);
  } else {
    good = code_write_pruned(w, code_write_follow, 0) && good;
  }
  code_write_range(w);
  if (w->rotors > 0) {
    code_write_settle(w);
  }
  code_template(w, code_enter);
  if (w->n > 0) {
    code_template(w, code_enter_modes);
  }
  code_template(w, w->rotors > 0 ? code_enter_rotors : "");
  code_template_of(w, 1, code_enter_single);
  code_template(w, w->vary & CODE_MASS ? code_enter_mass : "");
  code_template(w, "}\n");
  if (code_model.first < 6) {
    code_template_of(w, 1, code_keep_single);
  }
  code_write_end(w);
  return good;
}

static void code_write_stages(const code *w)
{
  const int limited = !code_model.body->allow_long_step;
  code_template(w, code_step_head);
  code_template(w, w->large && code_model.first == 0 ? "  $ center[3];\n" : "");
  code_template(w, w->central ? "  $ place[3];\n" : "");
  code_template(w, code_step_begin);
  code_template(w, w->central && code_model.first == 0 ? "  @_lead(%Aat);\n" : "");
  code_template(w, w->central ? "  memcpy(place, at + %r, sizeof place);\n" : "");
  if (w->large) {
    code_template(w, code_model.first == 0 ? "  memset(w, 0, sizeof w);\n  memset(center, 0, sizeof center);\n"
                                           : "  memset(w, 0, sizeof w);\n");
  }
  code_template(w, code_step_stages);
  if (w->large && limited) {
    code_template(w, "    w[9] = stage == 0 ? `1` : `0`; /* 1: with the step limit */\n");
  }
  code_template(w, code_step_call);
  if (w->large && code_model.first == 0) {
    code_template(w, "    if (stage == 0) {\n      memcpy(center, w + 6, sizeof center);\n    }\n");
  }
  code_template(w, limited ? code_step_limits : "");
  code_template(w, code_step_rest);
  code_template(w, w->central ? code_step_place : "");
  code_template(w, code_step_end);
  code_template(w, code_model.first == 0 && w->large ? ", center" : "");
  code_template(w, code_takes_last() ? ", end);\n}\n" : ");\n}\n");
}

/* All lanes at once, and the step that takes it. */
static int code_write_lanes(const code *w)
{
  const code wide = code_lanes_begin(w);
  int good;
  code_write_all_types(&wide);
  good = code_write_functions(&wide);
  code_write_stages(&wide);
  code_lanes_end(w);
  return good;
}

/* The declarations of the step of a body, and where its functions begin; coordinate: prints what one is. */
static code code_write_start(FILE *out, const fb_body *body, const code_choice *choice, const char *source,
                             void (*coordinate)(FILE *, int))
{
  const code w = {out,
                  choice->name,
                  choice->single,
                  body->n,
                  (body->effects & FB_EFFECT_LARGE_DEFLECTION) != 0,
                  2,
                  choice->vary,
                  0,
                  body->n_rotor,
                  0,
                  code_is_central(body),
                  choice->traced,
                  choice->places};
  code_read(body, choice->hub[0]);
  code_loads_choose(choice->loads);
  code_write_head(&w, body, source, choice->lanes, coordinate);
  code_template(&w, "\n#ifdef @_IMPLEMENTATION\n#include <math.h>\n#include <string.h>\n\n");
  return w;
}

/* Writes the step of a body that code_refusal takes. 0: there is no temporary file, see errno. */
static inline int code_write(FILE *out, const fb_body *body, const code_choice *choice, const char *source,
                             void (*coordinate)(FILE *, int))
{
  const code w = code_write_start(out, body, choice, source, coordinate);
  int good;
  code_template(&w, w.single ? "static const $ @_huge = `1e18`, @_tiny = `1e-12`, @_faint = `1e-18`;\n\n"
                             : "static const $ @_huge = `1e150`, @_tiny = `1e-100`, @_faint = `1e-106`;\n\n");
  code_template(&w, code_helpers);
  code_template(&w, w.large ? code_restrict : "");
  good = code_write_functions(&w);
  code_template(&w, code_start);
  good = (!w.vary || code_write_vary(&w)) && good;
  code_write_stages(&w);
  if (w.central && code_model.first < 6) {
    good = code_write_pruned(&w, code_write_potential, 0) && good;
  }
  good = code_write_read(&w) && good;
  good = (!choice->lanes || code_write_lanes(&w)) && good;
  fputs("#endif\n", out);
  return good;
}

/* What of a body is not written here, with what would be right; NULL: all is. The tracer writes some of it. */
static inline const char *code_refusal(const fb_body *body)
{
  if (body->effects & FB_EFFECT_LARGE_DEFLECTION && code_line_refusal(&body->lines)) {
    return code_line_refusal(&body->lines);
  }
  if (body->effects & FB_EFFECT_NONLINEAR_STRAIN) {
    return "effects strain: choose effects up to full";
  }
  if (code_rotors_refusal(body)) {
    return code_rotors_refusal(body);
  }
  if (code_is_central(body) && body->effects & FB_EFFECT_LARGE_DEFLECTION) {
    return "central_gravity of effects large: choose effects up to full, or uniform gravity";
  }
  return body->base == FB_BASE_HINGED ? "base hinged: choose base free, pinned or prescribed" : NULL;
}

/* Is a step written by the tracer, as this program does not? */
static inline int code_is_traced(const fb_body *body)
{
  return code_refusal(body) && !(body->effects & FB_EFFECT_LARGE_DEFLECTION);
}
#endif
