/* code_vary.h - parameters that stay variable in the step that code.h writes: factors of stiffness, damping and masses,
   which the shapes of the modes do not depend on.

   Kinetic energy is mass T(flexible) + hub_mass T(hub) + hub_inertia T(hub). By the factor of the mass, all of it, loads
   and momenta included, it is that of the body as described with another hub, another stiffness and other loads: so Lambda(q)
   and all coefficients of q stay literals, and only constants of the hub, K, C, loads and momenta are multiplied. */
#ifndef CODE_VARY_H
#define CODE_VARY_H
#include "code_model.h"
#include "code_text.h"

typedef struct code_choice { /* what is to be written */
  const char *name;
  int single, vary, lanes, traced, places;
  unsigned loads;    /* bits of the nodes that have a load */
  double hub[2][21]; /* M_rr of the hub: by its mass, by its inertia */
} code_choice;

static const struct code_parameter {
  const char *name, *what;
} code_parameters[] = {{"stiffness", "of K"},
                       {"damping", "of the damping ratios; from 0"},
                       {"mass", "of all but the hub"},
                       {"hub_mass", "of the hub; its mass center stays"},
                       {"hub_inertia", "of the hub, about its mass center"}};

enum { CODE_PARAMETERS = sizeof code_parameters / sizeof *code_parameters };

/* Bits of the names in a list with commas; 0: one is no parameter, or there twice. */
static inline int code_vary_read(const char *list)
{
  int vary = 0;
  for (const char *at = list; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
    const size_t length = strcspn(at, ",");
    int bit = 0;
    for (int k = 0; k < CODE_PARAMETERS; k++) {
      if (strlen(code_parameters[k].name) == length && strncmp(at, code_parameters[k].name, length) == 0) {
        bit = 1 << k;
      }
    }
    if (bit == 0 || vary & bit) {
      return 0;
    }
    vary |= bit;
  }
  return vary;
}

/* M_rr of a hub of that mass, mass center and inertia about it, xx yy zz xy xz yz. */
static inline void code_vary_hub(code_choice *choice, double mass, const double center[3], const double inertia[6])
{
  static const int packed[9] = {0, 3, 4, 3, 1, 5, 4, 5, 2};
  const double square = center[0] * center[0] + center[1] * center[1] + center[2] * center[2];
  memset(choice->hub, 0, sizeof choice->hub);
  for (int k = 0; k < 2; k++) {
    fb_real S[21], c[3], J[9];
    for (int i = 0; i < 9; i++) {
      c[i % 3] = k == 0 ? (fb_real)(mass * center[i % 3]) : FB_R(0.0);
      J[i] =
          (fb_real)(k == 0 ? mass * ((i % 4 == 0 ? square : 0.0) - center[i / 3] * center[i % 3]) : inertia[packed[i]]);
    }
    fbi_rigid_matrix(S, k == 0 ? (fb_real)mass : FB_R(0.0), c, J);
    for (int e = 0; e < 21 && choice->vary & CODE_HUB; e++) {
      choice->hub[k][e] = (double)S[e];
    }
  }
}

/* What of the choice a body has not, with what would be right; NULL: nothing. */
static inline const char *code_vary_refusal(const code_choice *choice, const fb_body *body, double hub_mass)
{
  const int large = (body->effects & FB_EFFECT_LARGE_DEFLECTION) != 0;
  if (choice->vary & CODE_HUB && large) {
    return "a body with effects large varies in stiffness and damping only";
  }
  if (choice->vary & CODE_HUB && body->n_rotor > 0) {
    return "a body with rotors varies in stiffness and damping only";
  }
  if (choice->vary & (CODE_HUB_MASS | CODE_HUB_INERTIA) && !(hub_mass > 0.0)) {
    return "hub_mass and hub_inertia are factors of a hub, which the description has not: leave them out";
  }
  if (choice->vary & CODE_STIFFNESS && body->n == 0) {
    return "stiffness: the body has no modes";
  }
  if (choice->vary & CODE_DAMPING && !(body->effects & FB_EFFECT_DAMPING)) {
    return "damping: the body has none; effects .. damping and a line damping give it some";
  }
  if (choice->vary & CODE_MASS && !((double)body->mass > (1.0 + 64.0 * DBL_EPSILON) * hub_mass)) {
    return "mass is that of all but the hub, which is all: choose hub_mass";
  }
  return NULL;
}

static const char code_vary_types[] =
    "typedef struct @_model { /* what parameters make of the description; by their factor of the mass: */\n"
    "  $ mass, share;                /* that factor, its inverse */\n"
    "  $ stiffness, damping;         /* factors of K and C */\n"
    "  $ hub_mass, hub_inertia;      /* factors of the hub's M_rr */\n"
    "  $ body, inverse, arm;         /* [kg] mass, [1/kg] its inverse, [m] distance of the mass center from O */\n"
    "  $ most_stiffness, most_damping, stiffening; /* factors of the bounds of the step limit */\n"
    "} @_model;\n\n";

/* By a trace; lanes of it are not aligned as vectors are. */
static void code_write_model_type(const code *w)
{
  char real[CODE_PREFIX + 16];
  snprintf(real, sizeof real, "%s%s", code_real(w), w->lanes == CODE_WIDE ? "_loose" : "");
  if (w->vary && !w->traced) {
    code_template(w, code_vary_types);
  } else if (w->vary) {
    code_template(w, "typedef struct @_model { /* what parameters make of the description */\n");
    fprintf(w->out, "  %s mass; /* their factor of the mass */\n", real);
    fprintf(w->out, "  %s k[%d]; /* its numbers that they change */\n", real, w->places);
    code_template(w, "} @_model;\n\n");
  }
}

static const char code_vary_declaration[] =
    "/* NULL: as described. @_value: a factor is not 1e-6 to 1e6 (damping: 0 to 1e6), or less of the hub than there "
    "can\n"
    "   be. */\n"
    "@_status @_model_init(@_model *model, const @_parameters *parameters);\n";

static void code_write_parameters(const code *w)
{
  code_template(
      w, "/* Factors of what the description says. Modes keep their shapes, and q and pi the unit of the modes as\n"
         "   described: displacements are those of the same q. */\n"
         "typedef struct @_parameters {\n");
  for (int k = 0; k < CODE_PARAMETERS; k++) {
    if (w->vary & 1 << k) {
      fprintf(w->out, "  %s %s; /* %s */\n", code_real(w), code_parameters[k].name, code_parameters[k].what);
    }
  }
  code_template(w, "} @_parameters;\n\n");
}

/* 1/m [1/kg] as text */
static void code_inverse_mass(char text[40], const code *w)
{
  if (w->vary & CODE_HUB) {
    strcpy(text, "model->inverse");
  } else {
    code_number(text, w, 1.0 / (double)code_model.body->mass);
  }
}

/* s += constant + its parts by the factors of the hub */
static void code_vary_add(code_sum *s, double constant, const double hub[2])
{
  code_add_one(s, constant, code_constant(1.0));
  code_add_one(s, hub[0], code_variable("model->hub_mass"));
  code_add_one(s, hub[1], code_variable("model->hub_inertia"));
}

/* ---- bounds of the step limit (E8.8) with another hub */

static void code_vary_table(const code *w, const char *name, double (*A)[FB_MAX_MODES], int rows)
{
  char number[40];
  code_template(w, "  static const $ ");
  fprintf(w->out, "%s[%d] = {", name, rows * w->n);
  for (int i = 0; i < rows * w->n; i++) {
    code_number(number, w, A[i / w->n][i % w->n]);
    fprintf(w->out, "%s%s", i == 0 ? "" : i % 5 == 0 ? ",\n      " : ", ", number);
  }
  fputs("};\n", w->out);
}

static const char code_vary_largest[] =
    "\n/* Largest eigenvalue of F^T G F, by Jacobi's rotations */\n"
    "static $ @_largest(const $ *F, const $ *G)\n{\n"
    "  $ A[%n * %n], most = `0`;\n"
    "  for (int a = 0; a < %n; a++) {\n    for (int b = 0; b < %n; b++) {\n"
    "      A[a * %n + b] = `0`;\n"
    "      for (int i = 0; i < %n * %n; i++) {\n"
    "        A[a * %n + b] += F[i / %n * %n + a] * G[i] * F[i %% %n * %n + b];\n      }\n    }\n  }\n"
    "  for (int round = 0; round < 12; round++) {\n"
    "    for (int p = 0; p < %n; p++) {\n      for (int q = p + 1; q < %n; q++) {\n"
    "        const $ apart = `0.5` * (A[q * %n + q] - A[p * %n + p]), off = A[p * %n + q];\n"
    "        const $ root = sqrt~(apart * apart + off * off);\n"
    "        const $ t = root > `0` ? off / (apart < `0` ? apart - root : apart + root) : `0`;\n"
    "        const $ c = `1` / sqrt~(`1` + t * t), s = t * c;\n"
    "        for (int k = 0; k < %n; k++) {\n"
    "          const $ x = A[p * %n + k], y = A[q * %n + k];\n"
    "          A[p * %n + k] = c * x - s * y;\n          A[q * %n + k] = s * x + c * y;\n        }\n"
    "        for (int k = 0; k < %n; k++) {\n"
    "          const $ x = A[k * %n + p], y = A[k * %n + q];\n"
    "          A[k * %n + p] = c * x - s * y;\n          A[k * %n + q] = s * x + c * y;\n        }\n"
    "      }\n    }\n  }\n"
    "  for (int a = 0; a < %n; a++) {\n    most = A[a * %n + a] > most ? A[a * %n + a] : most;\n  }\n"
    "  return most;\n}\n";

static const char code_vary_mobility[] =
    "  for (int i = 0; i < m; i++) { /* S = L L^T, L^-1 T */\n"
    "    for (int j = 0; j <= i; j++) {\n"
    "      $ sum = S[i][j];\n"
    "      for (int k = 0; k < j; k++) {\n        sum -= S[i][k] * S[j][k];\n      }\n"
    "      if (i == j && !(sum > `1e-12` * S[i][i])) {\n        return 0;\n      }\n"
    "      S[i][j] = i == j ? sqrt~(sum) : sum / S[j][j];\n    }\n"
    "    for (int a = 0; a < %n; a++) {\n"
    "      $ sum = T[i * %n + a];\n"
    "      for (int k = 0; k < i; k++) {\n        sum -= S[i][k] * X[k][a];\n      }\n"
    "      X[i][a] = sum / S[i][i];\n    }\n  }\n"
    "  for (int e = 0; e < %n * %n; e++) {\n"
    "    G[e] = W[e];\n"
    "    for (int k = 0; k < m; k++) {\n      G[e] += X[k][e / %n] * X[k][e %% %n];\n    }\n  }\n"
    "  return 1;\n}\n";

/* Lower triangle F of A = F F^T, of a matrix without negative eigenvalues. */
static void code_root(double F[FB_MAX_MODES][FB_MAX_MODES], double A[FB_MAX_MODES][FB_MAX_MODES], double unit, int n)
{
  memset(F, 0, sizeof(double) * FB_MAX_MODES * FB_MAX_MODES);
  for (int j = 0; j < n; j++) {
    double own = A[j][j] / unit;
    for (int m = 0; m < j; m++) {
      own -= F[j][m] * F[j][m];
    }
    F[j][j] = own > 1e-14 * fabs(A[j][j]) / unit ? sqrt(own) : 0.0;
    for (int i = j + 1; i < n && F[j][j] > 0.0; i++) {
      double sum = A[i][j] / unit;
      for (int m = 0; m < j; m++) {
        sum -= F[i][m] * F[j][m];
      }
      F[i][j] = sum / F[j][j];
    }
  }
}

static double code_vary_T[6][FB_MAX_MODES]; /* Lambda(0) M^-1, rows that the base leaves free */

/* T, and F with F F^T the inertia of the modes of the body as described, its mobility W + T^T S^-1 T inverted. */
static int code_vary_inertia(double F[FB_MAX_MODES][FB_MAX_MODES])
{
  const fb_body *const body = code_model.body;
  const int n = body->n;
  static fb_real G[FB_MAX_MODES * FB_MAX_MODES], column[FB_MAX_MODES];
  fb_real V[FB_MAX_MODES][6];
  fb_status status = FB_OK;
  memset(code_vary_T, 0, sizeof code_vary_T);
  for (int e = 0; e < 6 * n; e++) {
    for (int b = 0; b < n; b++) {
      code_vary_T[e / n][e % n] += code_model.lambda[e / n].constant[b] * code_model.W[b][e % n];
    }
  }
  for (int a = 0; a < n && status == FB_OK; a++) {
    fb_real y[6];
    for (int i = 0; i < 6; i++) {
      y[i] = (fb_real)code_vary_T[i][a];
    }
    status = fbi_base_solve(V[a], body->base, body->S0, y);
  }
  for (int e = 0; e < n * n && status == FB_OK; e++) {
    G[e] = (fb_real)code_model.W[e / n][e % n];
    for (int i = code_model.first; i < 6; i++) {
      G[e] += (fb_real)code_vary_T[i][e / n] * V[e % n][i];
    }
  }
  status = status == FB_OK ? fb_chol_factor(G, n) : status;
  for (int j = 0; j < n && status == FB_OK; j++) { /* row j of L^-T */
    memset(column, 0, sizeof column);
    column[j] = FB_R(1.0);
    fbi_chol_forward(column, G, column, n);
    for (int i = 0; i < n; i++) {
      F[j][i] = (double)column[i];
    }
  }
  return status == FB_OK;
}

static void code_write_mobility(const code *w)
{
  const int m = 6 - code_model.first;
  code_template(w, "\n/* G: inverse of the inertia of the modes of the free body at q = 0, W + T^T S^-1 T */\n"
                   "static int @_mobility($ *G, const @_model *model)\n{\n");
  code_vary_table(w, "W", code_model.W, w->n);
  code_vary_table(w, "T", code_vary_T + code_model.first, m);
  fprintf(w->out, "  enum { m = %d };\n", m);
  code_template(w, "  $ S[m][m], X[m][%n];\n");
  for (int i = 0; i < m; i++) {
    for (int j = 0; j <= i; j++) {
      const code_poly *const p = &code_model.S[fb_sym6_index(code_model.first + i, code_model.first + j)];
      code_sum s;
      code_begin(&s);
      code_vary_add(&s, p->constant, p->hub);
      code_assign(w, &s, code_variable("S[%d][%d]", i, j).name);
    }
  }
  fputs("  (void)model;\n", w->out);
  code_template(w, code_vary_mobility);
}

/* model->field *= largest eigenvalue of F^T G F by that as described */
static void code_write_bound(const code *w, const char *field, double F[FB_MAX_MODES][FB_MAX_MODES], double nominal)
{
  char number[40];
  if (nominal > 0.0) {
    code_number(number, w, 1.0 / nominal);
    fputs("  {\n", w->out);
    code_vary_table(w, "F", F, w->n);
    fprintf(w->out, "  model->%s *= %s * %s_largest(F, G);\n  }\n", field, number, w->name);
  }
}

static const char code_vary_init[] =
    "\n@_status @_model_init(@_model *model, const @_parameters *parameters)\n{\n"
    "  $ stiffness = `1`, damping = `1`, mass = `1`, hub_mass = `1`, hub_inertia = `1`;\n"
    "  if (!model) {\n    return @_null;\n  }\n"
    "  if (parameters) {\n";

static const char code_vary_factors[] =
    "  model->mass = mass;\n  model->share = `1` / mass;\n"
    "  model->stiffness = stiffness * model->share;\n"
    "  model->damping = damping * sqrt~(model->stiffness);\n"
    "  model->hub_mass = hub_mass * model->share;\n  model->hub_inertia = hub_inertia * model->share;\n"
    "  model->most_stiffness = model->stiffness;\n  model->most_damping = model->damping;\n"
    "  model->stiffening = `1`;\n";

static int code_write_bounds(const code *w)
{
  static double A[FB_MAX_MODES][FB_MAX_MODES], F[FB_MAX_MODES][FB_MAX_MODES];
  const fb_body *const body = code_model.body;
  code_template(w, "  if (!@_mobility(G, model)) {\n    return @_value;\n  }\n");
  code_read_sparse(A, &body->K, w->n);
  code_root(F, A, 1.0, w->n);
  code_write_bound(w, "most_stiffness", F, (double)body->limit_elastic);
#if FB_WITH_DAMPING
  if (body->effects & FB_EFFECT_DAMPING) {
    code_read_sparse(A, &body->C, w->n);
    code_root(F, A, 1.0, w->n);
    code_write_bound(w, "most_damping", F, (double)body->limit_damping);
  }
#endif
  if (!code_vary_inertia(F)) {
    return 0;
  }
  code_write_bound(w, "stiffening", F, 1.0);
  return 1;
}

/* The model of parameters, up to what is made of them. */
static void code_write_vary_start(const code *w)
{
  code_template(w, code_vary_init);
  for (int k = 0; k < CODE_PARAMETERS; k++) {
    if (w->vary & 1 << k) {
      fprintf(w->out, "    %s = parameters->%s;\n", code_parameters[k].name, code_parameters[k].name);
    }
  }
  fputs("  }\n", w->out);
  for (int k = 0; k < CODE_PARAMETERS; k++) {
    if (w->vary & 1 << k) {
      const char *const name = code_parameters[k].name;
      fprintf(w->out, "  if (!(%s >= ", name);
      code_template(w, 1 << k == CODE_DAMPING ? "`0` && " : "`1e-6` && ");
      fputs(name, w->out);
      code_template(w, " <= `1e6`)) {\n    return @_value;\n  }\n");
    }
  }
}

/* The same, where a trace writes what is made of them. */
static const char code_vary_traced[] =
    "\n/* What a trace makes of factors. */\n"
    "static @_status @_numbers(@_model *model, $ stiffness, $ damping, $ mass, $ hub_mass, $ hub_inertia);\n";

static const char code_vary_traced_end[] =
    "  if (@_numbers(model, stiffness, damping, mass, hub_mass, hub_inertia) != @_ok) {\n    return @_value;\n  }\n"
    "  model->mass = mass;\n  return @_ok;\n}\n";

/* The model of parameters. */
static int code_write_vary(const code *w)
{
  static double F[FB_MAX_MODES][FB_MAX_MODES];
  const int bounds = w->vary & CODE_HUB && w->n > 0 && code_model.first < 6 && !code_model.body->allow_long_step;
  const double hub[2] = {code_model.hub[0][0], 0.0};
  int good = 1;
  code_sum s;
  if (bounds) {
    good = code_vary_inertia(F);
    code_template(w, code_vary_largest);
    code_write_mobility(w);
  }
  code_write_vary_start(w);
  code_template(w, code_vary_factors);
  code_begin(&s);
  code_vary_add(&s, (double)code_model.body->mass - hub[0], hub);
  code_assign(w, &s, "model->body");
  code_template(w, "  model->inverse = `1` / model->body;\n  {\n    $ c[3];\n");
  for (int i = 0; i < 3; i++) {
    const code_poly *const p = &code_model.poly[i];
    code_begin(&s);
    code_vary_add(&s, p->constant, p->hub);
    code_assign(w, &s, code_variable("  c[%d]", i).name);
  }
  code_template(w, "    model->arm = @_norm(c) * model->inverse;\n  }\n");
  if (bounds) {
    code_template(w, "  {\n    $ G[%n * %n];\n");
    good = code_write_bounds(w) && good;
    fputs("  }\n", w->out);
  }
  code_template(w, "  return @_ok;\n}\n");
  return good;
}
#endif
