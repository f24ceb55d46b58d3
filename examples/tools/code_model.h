/* code_model.h - the polynomials of a body as code.h writes them: Lambda(q) of E8.9 by rows, S(q) of E8.11, and
   M_rr(q) = S + Lambda M^-1 Lambda^T, of degree 2 as S; from the tables of a fb_body. Include flexbeam.h first. */
#ifndef CODE_MODEL_H
#define CODE_MODEL_H
#include <float.h>
#include <math.h>
#include <string.h>

typedef struct code_row { /* element b: constant_b + sum of slope_ba q_a */
  double constant[FB_MAX_MODES], slope[FB_MAX_MODES][FB_MAX_MODES];
} code_row;

typedef struct code_poly { /* constant + linear.q + 1/2 q.square q */
  double hub[2];           /* by the factors of the hub's mass and inertia, where these vary; not in the constant */
  double constant, linear[FB_MAX_MODES], square[FB_MAX_MODES][FB_MAX_MODES];
} code_poly;

enum { CODE_POLY = 28 };

static const char *const code_rows[6] = {"vx", "vy", "vz", "wx", "wy", "wz"};

static struct code_model {
  const fb_body *body;
  int n, constant_S;
  double hub[2]
            [21]; /* M_rr of the hub by its mass and its inertia about its mass center; zero where they do not vary */
  int large;      /* 1: with lines; what follows is then of the rest of the body, S its M_rr */
  int first;      /* of the rows (v, w) that the base leaves free: 0 free, 3 pinned, 6 prescribed */
  double W[FB_MAX_MODES][FB_MAX_MODES]; /* M^-1; with lines M of the rest */
  code_row lambda[6];
  code_poly S[21];
  int n_poly; /* different ones: c(q) by axes first */
  code_poly poly[CODE_POLY];
  char name[CODE_POLY][12];
  double scale[CODE_POLY]; /* 2: gradients are written as half of them */
  int n_part[21];          /* element of M_rr: the sum of so many polynomials.. */
  int part[21][2];
  double sign[21][2]; /* ..with signs */
} code_model;

/* A coefficient that is 1 or 2, or that of the other sign, but for round-off. */
static double code_snap(double x)
{
  const double near = floor(x + 0.5);
  return (fabs(near) <= 2.0 && fabs(x - near) <= 8.0 * DBL_EPSILON * fabs(near)) ? near : x;
}

static void code_read_lambda(const fb_body *body)
{
  memset(code_model.lambda, 0, sizeof code_model.lambda);
  for (int t = 0; t < body->n_lambda; t++) {
    const fb_lambda_term *const term = &body->lambda[t];
    code_row *const row = &code_model.lambda[term->i];
    double *const to = term->a == 0 ? &row->constant[term->b] : &row->slope[term->b][term->a - 1];
    *to = code_snap(*to - (double)term->c);
  }
}

/* p += c (1, q)_a (1, q)_b, a >= b */
static void code_poly_add(code_poly *p, double c, int a, int b)
{
  if (a == 0) {
    p->constant += c;
  } else if (b == 0) {
    p->linear[a - 1] += c;
  } else {
    p->square[a - 1][b - 1] += c;
    p->square[b - 1][a - 1] += c;
  }
}

/* Takes from the constant of p what the hub gives to element e of M_rr, without round-off. */
static void code_poly_hub(code_poly *p, int e)
{
  const double size = fabs(p->constant);
  for (int k = 0; k < 2; k++) {
    p->hub[k] = code_model.hub[k][e];
    p->constant -= p->hub[k];
  }
  p->constant = fabs(p->constant) <= 64.0 * DBL_EPSILON * size ? 0.0 : p->constant;
}

static void code_read_S(const fb_body *body)
{
  memset(code_model.S, 0, sizeof code_model.S);
  for (int i = 0; i < 21; i++) {
    code_model.S[i].constant = (double)body->S0[i];
    code_poly_hub(&code_model.S[i], i);
  }
  for (const fb_lambda_term *t = body->S + body->n_slope_alone; t < body->S + body->n_S; t++) {
    const int moment = t->i - 21;
    code_poly_add(&code_model.S[moment < 0 ? t->i : fbi_S_pair[moment][0]], (double)t->c, t->a, t->b);
    if (moment >= 0) {
      code_poly_add(&code_model.S[fbi_S_pair[moment][1]], moment < 3 ? -(double)t->c : (double)t->c, t->a, t->b);
    }
  }
}

static void code_read_sparse(double A[FB_MAX_MODES][FB_MAX_MODES], const fb_sparse *from, int n)
{
  memset(A, 0, sizeof(double) * FB_MAX_MODES * FB_MAX_MODES);
  for (int a = 0; a < n; a++) {
    A[a][a] = (double)from->diagonal[a];
  }
  for (int t = 0; t < from->n_term; t++) {
    A[from->term[t].a][from->term[t].b] += (double)from->term[t].c;
    A[from->term[t].b][from->term[t].a] += (double)from->term[t].c;
  }
}

/* Stiffness and damping of the modes. */
static void code_read_springs(double K[FB_MAX_MODES][FB_MAX_MODES], double C[FB_MAX_MODES][FB_MAX_MODES],
                              const fb_body *body)
{
  code_read_sparse(K, &body->K, body->n);
  memset(C, 0, sizeof(double) * FB_MAX_MODES * FB_MAX_MODES);
#if FB_WITH_DAMPING
  if (body->effects & FB_EFFECT_DAMPING) {
    code_read_sparse(C, &body->C, body->n);
  }
#endif
}

static void code_read_mass(const fb_body *body)
{
  if (!body->unit_mass || code_model.large) {
    code_read_sparse(code_model.W, code_model.large ? &body->M_rest : &body->Minv, body->n);
    return;
  }
  memset(code_model.W, 0, sizeof code_model.W);
  for (int a = 0; a < body->n; a++) {
    code_model.W[a][a] = 1.0;
  }
}

/* |x| where magnitudes are asked for */
static double code_part(double x, int magnitude)
{
  return magnitude ? fabs(x) : x;
}

/* p += w (row i)_b (row j)_c */
static void code_product_add(code_poly *p, double w, const code_row *i, int b, const code_row *j, int c, int magnitude)
{
  const double x = code_part(i->constant[b], magnitude), y = code_part(j->constant[c], magnitude);
  p->constant += w * x * y;
  for (int a = 0; a < code_model.n; a++) {
    const double slope = w * code_part(i->slope[b][a], magnitude);
    p->linear[a] += slope * y + w * x * code_part(j->slope[c][a], magnitude);
    for (int d = 0; d < code_model.n && fabs(slope) > 0.0; d++) {
      const double both = slope * code_part(j->slope[c][d], magnitude);
      p->square[a][d] += both;
      p->square[d][a] += both;
    }
  }
}

/* p += Lambda_i M^-1 Lambda_j^T */
static void code_products_add(code_poly *p, int i, int j, int magnitude)
{
  for (int b = 0; b < code_model.n; b++) {
    for (int c = 0; c < code_model.n; c++) {
      const double w = code_part(code_model.W[b][c], magnitude);
      if (fabs(w) > 0.0) {
        code_product_add(p, w, &code_model.lambda[i], b, &code_model.lambda[j], c, magnitude);
      }
    }
  }
}

/* p, and the magnitudes of all its coefficients */
static void code_poly_magnitude(code_poly *out, const code_poly *p)
{
  out->constant = fabs(p->constant) + fabs(p->hub[0]) + fabs(p->hub[1]);
  for (int a = 0; a < code_model.n; a++) {
    out->linear[a] = fabs(p->linear[a]);
    for (int b = 0; b < code_model.n; b++) {
      out->square[a][b] = fabs(p->square[a][b]);
    }
  }
}

/* x, or zero where it is round-off of what is as large as `size` */
static double code_chop(double x, double size)
{
  return fabs(x) <= 1024.0 * DBL_EPSILON * size ? 0.0 : code_snap(x);
}

/* Size of element e of S, of the undeformed body: below its round-off it is that of a sum that cancels. */
static double code_size(const fb_body *body, int e)
{
  const int i = fbi_sym6_row[e], j = fbi_sym6_column[e];
  return sqrt(fabs((double)body->S0[fb_sym6_index(i, i)] * (double)body->S0[fb_sym6_index(j, j)]));
}

/* x as a coefficient of the body, or zero where it is round-off of `size` */
static double code_whole(double x, double size)
{
  return fabs(x) <= 16.0 * DBL_EPSILON * size ? 0.0 : x;
}

/* M_rr_ij, in which what S and Lambda M^-1 Lambda^T have in common is gone: coefficients of round-off become zero. */
static void code_make_M(code_poly *p, code_poly *size, int i, int j)
{
  *p = code_model.S[fb_sym6_index(i, j)];
  code_poly_magnitude(size, p);
  if (!code_model.large) {
    code_products_add(p, i, j, 0);
    code_products_add(size, i, j, 1);
  }
  p->constant = code_whole(code_chop(p->constant, size->constant), code_size(code_model.body, fb_sym6_index(i, j)));
  for (int a = 0; a < code_model.n; a++) {
    p->linear[a] = code_chop(p->linear[a], size->linear[a]);
    for (int b = 0; b < code_model.n; b++) {
      p->square[a][b] = code_chop(p->square[a][b], size->square[a][b]);
    }
  }
}

/* 1 if x and y differ by no more than round-off of size */
static int code_alike(double x, double y, double size)
{
  return fabs(x - y) <= 4096.0 * DBL_EPSILON * size;
}

/* 1 if p = s o, size: magnitudes of what p is the sum of */
static int code_poly_alike(const code_poly *p, double s, const code_poly *o, const code_poly *size)
{
  int same = code_alike(p->constant, s * o->constant, size->constant) &&
             code_alike(p->hub[0], s * o->hub[0], size->constant) &&
             code_alike(p->hub[1], s * o->hub[1], size->constant);
  for (int a = 0; a < code_model.n; a++) {
    same = same && code_alike(p->linear[a], s * o->linear[a], size->linear[a]);
    for (int b = 0; b < code_model.n; b++) {
      same = same && code_alike(p->square[a][b], s * o->square[a][b], size->square[a][b]);
    }
  }
  return same;
}

static int code_poly_new(const code_poly *p, const char *name, double scale)
{
  const int k = code_model.n_poly++;
  code_model.poly[k] = *p;
  code_model.scale[k] = scale;
  snprintf(code_model.name[k], sizeof code_model.name[k], "%s", name);
  return k;
}

/* element += sign times polynomial k */
static void code_part_add(int element, int k, double sign)
{
  const int at = code_model.n_part[element]++;
  code_model.part[element][at] = k;
  code_model.sign[element][at] = sign;
}

/* Finds p, or minus it, among the polynomials, or adds it. */
static void code_classify(int element, const code_poly *p, const code_poly *size)
{
  char name[12];
  for (int k = 0; k < code_model.n_poly; k++) {
    for (int s = -1; s <= 1; s += 2) {
      if (code_poly_alike(p, s, &code_model.poly[k], size)) {
        code_part_add(element, k, s);
        return;
      }
    }
  }
  snprintf(name, sizeof name, "M_%s_%s", code_rows[fbi_sym6_row[element]], code_rows[fbi_sym6_column[element]]);
  code_part_add(element, code_poly_new(p, name, fbi_sym6_row[element] == fbi_sym6_column[element] ? 2.0 : 1.0), 1.0);
}

/* p = sum of s_i x_i of three, without their round-off */
static void code_combine(code_poly *p, const double s[3], const code_poly x[3], const code_poly size[3])
{
  for (int k = 0; k < 2; k++) {
    p->hub[k] = code_chop(s[0] * x[0].hub[k] + s[1] * x[1].hub[k] + s[2] * x[2].hub[k],
                          size[0].constant + size[1].constant + size[2].constant);
  }
  p->constant = s[0] * x[0].constant + s[1] * x[1].constant + s[2] * x[2].constant;
  p->constant = fabs(p->constant) <= 64.0 * DBL_EPSILON * (size[0].constant + size[1].constant + size[2].constant)
                    ? 0.0
                    : p->constant;
  for (int a = 0; a < code_model.n; a++) {
    p->linear[a] = code_chop(s[0] * x[0].linear[a] + s[1] * x[1].linear[a] + s[2] * x[2].linear[a],
                             size[0].linear[a] + size[1].linear[a] + size[2].linear[a]);
    for (int b = 0; b < code_model.n; b++) {
      p->square[a][b] = code_chop(s[0] * x[0].square[a][b] + s[1] * x[1].square[a][b] + s[2] * x[2].square[a][b],
                                  size[0].square[a][b] + size[1].square[a][b] + size[2].square[a][b]);
    }
  }
}

static int code_poly_count(const code_poly *p)
{
  int n = 0;
  for (int a = 0; a < code_model.n; a++) {
    n += fabs(p->linear[a]) > 0.0;
    for (int b = 0; b < code_model.n; b++) {
      n += fabs(p->square[a][b]) > 0.0;
    }
  }
  return n;
}

/* The moments of inertia J_x, J_y, J_z, or where these have fewer coefficients the second moments of mass
   E_x = (J_y + J_z - J_x)/2 and so on: J_x = E_y + E_z. */
static void code_make_moments(void)
{
  static const int element[3] = {15, 18, 20};
  static code_poly J[3], size[3], E[3];
  int by_J = 0, by_E = 0;
  for (int i = 0; i < 3; i++) {
    code_make_M(&J[i], &size[i], 3 + i, 3 + i);
    by_J += code_poly_count(&J[i]);
  }
  for (int i = 0; i < 3; i++) {
    const double s[3] = {i == 0 ? -0.5 : 0.5, i == 1 ? -0.5 : 0.5, i == 2 ? -0.5 : 0.5};
    code_combine(&E[i], s, J, size);
    by_E += code_poly_count(&E[i]);
  }
  for (int i = 0; i < 3; i++) {
    if (by_E >= by_J) {
      code_classify(element[i], &J[i], &size[i]);
    } else {
      const char name[4] = {'E', '_', (char)('x' + i), 0};
      const int k = code_poly_new(&E[i], name, 2.0);
      code_part_add(element[(i + 1) % 3], k, 1.0);
      code_part_add(element[(i + 2) % 3], k, 1.0);
    }
  }
}

/* First moment of mass of the undeformed body, without its lines. */
static const fb_real *code_center(const fb_body *body)
{
  return code_model.large ? body->c_rest : body->c;
}

/* c(q), first moment of mass, by axes: its gradient are the first three rows of Lambda (E8.16). */
static void code_make_center(const fb_body *body)
{
  static code_poly p;
  code_model.n_poly = 0;
  memset(&p, 0, sizeof p);
  for (int i = 0; i < 3; i++) {
    const char name[4] = {'c', '_', (char)('x' + i), 0};
    const int e = fb_sym6_index((i + 1) % 3, 3 + (i + 2) % 3); /* row v, column w of M_rr: -c^ */
    p.constant = code_whole((double)code_center(body)[i], code_size(body, e));
    code_poly_hub(&p, e);
    for (int b = 0; b < body->n; b++) {
      p.linear[b] = code_model.lambda[i].constant[b];
      for (int a = 0; a < body->n; a++) {
        p.square[b][a] = code_model.lambda[i].slope[b][a];
      }
    }
    code_poly_new(&p, name, 1.0);
  }
}

/* Does gravity of a center act on it, which needs M_rr(q) of all bodies? */
static int code_is_central(const fb_body *body)
{
  return (body->effects & FB_EFFECT_CENTRAL_GRAVITY) != 0;
}

/* The polynomials of a body. */
static void code_read(const fb_body *body, const double *hub)
{
  static code_poly p, size;
  memcpy(code_model.hub, hub, sizeof code_model.hub);
  code_model.body = body;
  code_model.n = body->n;
  code_model.large = (body->effects & FB_EFFECT_LARGE_DEFLECTION) != 0;
  code_model.constant_S = body->constant_S && !code_model.large && (body->n == 0 || !code_is_central(body));
  code_model.first = fbi_first_free(body->base);
  code_read_mass(body);
  code_read_lambda(body);
  code_read_S(body);
  code_make_center(body);
  memset(code_model.n_part, 0, sizeof code_model.n_part);
  for (int e = 0; e < 21 && (!code_model.constant_S || code_is_central(body)); e++) {
    const int i = fbi_sym6_row[e], j = fbi_sym6_column[e];
    if (i < 3 || i != j) {
      code_make_M(&p, &size, i, j);
      code_classify(e, &p, &size);
    }
  }
  if (!code_model.constant_S || code_is_central(body)) {
    code_make_moments();
  }
}

/* Uniform gravity of the description [m/s^2], inertial axis i. */
static double code_gravity(int i)
{
#if FB_WITH_GRAVITY
  return code_model.body->effects & FB_EFFECT_GRAVITY ? (double)code_model.body->gravity[i] : 0.0;
#else
  return 0.0 * i;
#endif
}
#endif
