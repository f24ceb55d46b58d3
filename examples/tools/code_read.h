/* code_read.h - writes what is read off a state: rates, motion, energy, nodes with sensors, for the step of code.h,
   whose functions it uses. */
#ifndef CODE_READ_H
#define CODE_READ_H
#include "code_model.h"
#include "code_line.h"
#include "code_rotors.h"
#include "code_text.h"
#include "code_vary.h"

static const char code_read_types[] = "\ntypedef struct @_motion {\n"
                                      "  $ v[3], w[3]; /* [m/s], [rad/s] of O, body axes */\n"
                                      "  $ q_dot[%m];\n";

static const char code_node_type[] = "typedef struct @_node { /* inertial axes */\n"
                                     "  $ position[3], quat[4];         /* [m], attitude of the section */\n"
                                     "  $ velocity[3], angular_rate[3]; /* [m/s], [rad/s] */\n"
                                     "} @_node;\n\n";

static const char code_energy_type[] = "typedef struct @_energy {\n"
                                       "  $ kinetic, strain, gravity; /* [J]; gravity is that of the description */\n"
                                       "} @_energy;\n\n";

static const char code_read_types_end[] =
    "/* Time derivatives of rho, quat, u, L, q, pi; rho_dot is the velocity of O. */\n"
    "@_status @_rates_eval(%M@_state *rate, const @_state *state, const @_input *in);\n"
    "@_status @_motion_eval(%M@_motion *motion, const @_state *state, const @_input *in);\n"
    "/* Node 0 is O, the others are those of the description in its order. @_value: no such node. */\n"
    "@_status @_node_eval(%M@_node *out, const @_state *state, const @_motion *motion, int node);\n";

static const char code_energy_declaration[] = "@_status @_energy_eval(%M@_energy *energy, const @_state *state);\n";

static void code_write_center_rate(const code *w, int unused)
{
  code_sum s;
  (void)unused;
  code_template(w, "\n/* (dc/dq) q_dot */\nstatic void @_center_rate($ *c_dot, const $ *q, const $ *q_dot)\n{\n");
  for (int i = 0; i < 3; i++) {
    code_value slope[FB_MAX_MODES];
    char target[32];
    for (int b = 0; b < w->n; b++) {
      code_begin(&s);
      code_add_one(&s, code_model.lambda[i].constant[b], code_constant(1.0));
      for (int a = 0; a < w->n; a++) {
        code_add_one(&s, code_model.lambda[i].slope[b][a], code_variable("q[%d]", a));
      }
      slope[b] = code_end(w, &s, code_variable("L_%s_%d", code_rows[i], b));
    }
    code_begin(&s);
    for (int b = 0; b < w->n; b++) {
      code_add(&s, 1.0, slope[b], code_variable("q_dot[%d]", b));
    }
    snprintf(target, sizeof target, "c_dot[%d]", i);
    code_assign(w, &s, target);
  }
  fputs("  (void)q, (void)q_dot;\n}\n", w->out);
}

/* A displacement or rotation of second degree along axis i, x = psi q + 1/2 chi q q, and its rate. chi: NULL: none. */
static void code_write_displacement(const code *w, const char *name, int i, const fb_real *psi, const fb_real *chi)
{
  code_sum x, rate, s;
  char target[32];
  code_begin(&x);
  code_begin(&rate);
  for (int a = 0; a < w->n; a++) {
    const double first = (double)psi[3 * a + i];
    code_value slope;
    code_begin(&s);
    code_add_one(&s, first, code_constant(1.0));
    for (int b = 0; b < w->n && chi; b++) {
      code_add_one(&s, (double)chi[(a > b ? 3 * (a * (a + 1) / 2 + b) : 3 * (b * (b + 1) / 2 + a)) + i],
                   code_variable("q[%d]", b));
    }
    slope = code_end(w, &s, code_variable("J_%s_%d_%d", name, i, a));
    code_add_one(&x, 0.5 * first, code_variable("q[%d]", a));
    code_add(&x, 0.5, slope, code_variable("q[%d]", a));
    code_add(&rate, 1.0, slope, code_variable("q_dot[%d]", a));
  }
  snprintf(target, sizeof target, "%s[%d]", name, i);
  code_assign(w, &x, target);
  snprintf(target, sizeof target, "%s_dot[%d]", name, i);
  code_assign(w, &rate, target);
}

static const char code_read_rotation[] =
    "  {\n"
    "    const $ share = `1` / (`1` + `0.25` * (phi[0] * phi[0] + phi[1] * phi[1] + phi[2] * phi[2]));\n"
    "    const $ half = `0.5` * sqrt~(share);\n"
    "    for (int i = 0; i < 3; i++) {\n"
    "      const int y = i < 2 ? i + 1 : 0, z = i > 0 ? i - 1 : 2;\n"
    "      spin[i] = share * (phi_dot[i] + `0.5` * (phi[y] * phi_dot[z] - phi[z] * phi_dot[y]));\n"
    "      turn[1 + i] = half * phi[i];\n"
    "    }\n"
    "    turn[0] = `2` * half;\n"
    "  }\n";

/* of: what begins the number of a node. */
static void code_write_node_of(const code *w, const char *of, int k)
{
  const fb_node *const node = &code_model.body->node[k];
  const fb_real *chi = NULL, *chi_theta = NULL;
#if FBI_WITH_QUADRATIC
  if (code_model.body->effects & (FB_EFFECT_SPIN_STIFFENING | FB_EFFECT_ACCELERATION_STIFFENING)) {
    chi = node->chi;
    chi_theta = node->chi_theta;
  }
#endif
  fprintf(w->out, "\n/* E8.14: displacement [m] and rotation of node %d with their rates, body axes */\n", k);
  code_template(w, "static void @_node_");
  fprintf(w->out, "%s%d", of, k);
  code_template(w, w->large
                       ? "($ *u, $ *turn, $ *u_dot, $ *spin, const $ *q, const $ *q_dot)\n{\n  $ phi[3], phi_dot[3];\n"
                       : "($ *u, $ *phi, $ *u_dot, $ *phi_dot, const $ *q, const $ *q_dot)\n{\n");
  for (int i = 0; i < 3; i++) {
    code_write_displacement(w, "u", i, node->psi, chi);
    code_write_displacement(w, "phi", i, node->theta, chi_theta);
  }
  fputs("  (void)q, (void)q_dot;\n", w->out);
  if (w->large) { /* to a quaternion and an angular velocity */
    code_template(w, code_read_rotation);
  }
  fputs("}\n", w->out);
}

static void code_write_node(const code *w, int k)
{
  code_write_node_of(w, "", k);
}

/* Axes of a line and body axes: element i, j of the matrix that takes the former to the latter. */
static double code_node_axes(const fb_line *line, int i, int j)
{
  return line->turned ? (double)line->axes[3 * i + j] : i == j ? 1.0 : 0.0;
}

/* target[i] = line vector v in body axes, + less[i] */
static void code_node_assign(const code *w, const fb_line *line, const char *target, int at, const code_vec *v,
                             const fb_real *less)
{
  for (int i = 0; i < 3; i++) {
    code_sum s;
    code_begin(&s);
    for (int j = 0; j < 3; j++) {
      code_add_one(&s, code_node_axes(line, i, j), v->x[j]);
    }
    code_add_one(&s, less ? -(double)less[i] : 0.0, code_constant(1.0));
    code_assign(w, &s, code_variable("%s[%d]", target, at + i).name);
  }
}

/* Coordinates times n x 3 of a node. */
static code_vec code_node_rows(const code *w, const char *name, const fb_real *rows, const char *by)
{
  code_vec out;
  for (int i = 0; i < 3; i++) {
    code_sum s;
    code_begin(&s);
    for (int a = 0; a < code_line.n; a++) {
      code_add_one(&s, (double)rows[3 * a + i], code_variable("%s[%d]", by, code_line.line->first + a));
    }
    out.x[i] = code_end(w, &s, code_variable("%s_%c", name, code_axis[i]));
  }
  return out;
}

/* E14.14: a node on a line; of: what begins its number. */
static void code_write_line_node_of(const code *w, const char *of, int k)
{
  const fb_node *const node = &code_model.body->node[k];
  const fb_line_node *const at = &node->line;
  const fb_line *line;
  const int number = at->line - 1;
  code_vec A, B, mixed, phi, A_dot, B_dot, rate, pr, r, v, spin, before;
  code_value x, prod, p[4], d[4], now[4], b_prod;
  code_sum s;
  int after;
  code_line = code_lines[number];
  line = code_line.line;
  after = at->after ? at->after - 1 - line->point : -1;
  fprintf(w->out, "\n/* E14.14: displacement [m] and rotation of node %d with their rates, body axes */\n", k);
  code_template(w, "static int @_node_");
  fprintf(w->out, "%s%d", of, k);
  code_template(w, "($ *u, $ *turn, $ *u_dot, $ *spin, const $ *q, const $ *q_dot)\n{\n"
                   "  static const $ rest[3] = {`0`, `0`, `0`};\n  @_line_");
  fprintf(w->out, "%d line, *const l = &line;\n", code_line.number);
  code_template(w, "  const int sound = @_pose_");
  fprintf(w->out, "%d(l, q + %d);\n", code_line.number, line->first);
  code_template(w, "  @_inertia_");
  fprintf(w->out, "%d(l%s", code_line.number, code_line.centered ? ", rest" : "");
  if (line->moves) {
    fprintf(w->out, ", q + %d", line->first);
  }
  fputs(");\n", w->out);
  code_template(w, "  @_drift_");
  fprintf(w->out, "%d(l, q_dot + %d, rest);\n", code_line.number, line->first);

  /* the interval before it */
  A = code_node_rows(w, "A", at->turn, "q");
  B = code_node_rows(w, "B", at->bow, "q");
  A_dot = code_node_rows(w, "A_dot", at->turn, "q_dot");
  B_dot = code_node_rows(w, "B_dot", at->bow, "q_dot");
  mixed = code_cross(w, "m", &A, &B);
  for (int i = 0; i < 3; i++) {
    code_value both;
    code_begin(&s);
    code_add_one(&s, 1.0, A.x[i]);
    code_add_one(&s, -1.0 / 6.0, mixed.x[i]);
    phi.x[i] = code_end(w, &s, code_variable("phi_%c", code_axis[i]));
    code_begin(&s);
    code_add_cross(&s, 1.0, &A_dot, &B, i);
    code_add_cross(&s, 1.0, &A, &B_dot, i);
    both = code_end(w, &s, code_variable("both_%c", code_axis[i]));
    code_begin(&s);
    code_add_one(&s, 1.0, A_dot.x[i]);
    code_add_one(&s, -1.0 / 6.0, both);
    rate.x[i] = code_end(w, &s, code_variable("rate_%c", code_axis[i]));
  }
  code_begin(&s);
  for (int i = 0; i < 3; i++) {
    code_add(&s, 1.0, phi.x[i], phi.x[i]);
  }
  code_declare(w, &s, "x");
  x = code_variable("x");
  code_line_turn(w);
  code_template(w, "    const $ half = sqrt~(`1` - `0.5` * a * x);\n"
                   "    const $ share = (`0.5` - `0.5` * b * x) / half;\n");

  /* attitude */
  d[0] = code_variable("half");
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add(&s, 1.0, code_variable("share"), phi.x[i]);
    d[1 + i] = code_end(w, &s, code_variable("d_%c", code_axis[i]));
  }
  for (int i = 0; i < 4; i++) {
    p[i] = code_constant(i == 0);
    if (after >= 0 && !(i > 0 && code_line.plane && code_is_zero(&code_line.phi.x[i - 1]))) {
      p[i] = code_variable("l->quat_%c[%d]", "wxyz"[i], after);
    }
  }
  code_quat_product(w, now, p, d, "n");
  code_begin(&s);
  code_add_one(&s, 1.0, now[0]);
  code_assign(w, &s, "turn[0]");
  for (int i = 0; i < 3; i++) {
    v.x[i] = now[1 + i];
  }
  code_node_assign(w, line, "turn", 1, &v, NULL);

  /* its rate: w before + H before (1 - b x + a phi^ + b phi phi^T) phi_dot */
  prod = code_dot(w, "prod", &phi, &rate);
  code_begin(&s);
  code_add(&s, 1.0, code_variable("b"), prod);
  b_prod = code_end(w, &s, code_variable("b_prod"));
  code_begin(&s);
  code_add_one(&s, 1.0, code_constant(1.0));
  code_add(&s, -1.0, code_variable("b"), x);
  x = code_end(w, &s, code_variable("sigma"));
  mixed = code_cross(w, "pr", &phi, &rate);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add(&s, 1.0, x, rate.x[i]);
    code_add(&s, 1.0, code_variable("a"), mixed.x[i]);
    code_add(&s, 1.0, b_prod, phi.x[i]);
    pr.x[i] = code_end(w, &s, code_variable("own_%c", code_axis[i]));
  }
  before.x[0] = before.x[1] = before.x[2] = code_constant(0.0);
  for (int i = 0; i < 3 && after >= 0; i++) {
    if (code_line.w.x[i].name[0] == 'l') {
      char place[16];
      snprintf(place, sizeof place, "%d", after);
      before.x[i] = code_at(code_line.w.x[i], place);
    }
  }
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, before.x[i]);
    for (int j = 0; j < 3; j++) {
      char place[16];
      snprintf(place, sizeof place, "%d", after);
      code_add(&s, 1.0, after < 0 ? code_constant(i == j) : code_at(code_line.H[i][j], place), pr.x[j]);
    }
    spin.x[i] = code_end(w, &s, code_variable("spin_%c", code_axis[i]));
  }
  code_node_assign(w, line, "spin", 0, &spin, NULL);

  /* place */
  for (int i = 0; i < 3; i++) {
    code_sum move;
    code_begin(&s);
    code_begin(&move);
    code_add_one(&s, (double)at->start[i], code_constant(1.0));
    for (int j = 0; j < line->count; j++) {
      code_add_one(&s, (double)at->weight[j], code_vec_at(&code_line.t, j).x[i]);
      code_add_one(&move, (double)at->weight[j], code_vec_at(&code_line.tau, j).x[i]);
    }
    for (int a = 0; a < code_line.n; a++) {
      code_add_one(&s, code_line_shift(a, i), code_variable("q[%d]", line->first + a));
      code_add_one(&move, code_line_shift(a, i), code_variable("q_dot[%d]", line->first + a));
    }
    r.x[i] = code_end(w, &s, code_variable("r_%c", code_axis[i]));
    v.x[i] = code_end(w, &move, code_variable("v_%c", code_axis[i]));
  }
  code_node_assign(w, line, "u", 0, &r, node->r);
  code_node_assign(w, line, "u_dot", 0, &v, NULL);
  fputs("  return sound;\n}\n", w->out);
}

static void code_write_line_node(const code *w, int k)
{
  code_write_line_node_of(w, "", k);
}

static const char code_read_motion[] =
    "\n@_status @_motion_eval(%M@_motion *motion, const @_state *state, const @_input *in)\n{\n"
    "  $ x[%N], rate[%N], w[%w], a;\n"
    "  @_motion own;\n"
    "  @_status status;\n"
    "  if (!motion || !state%Q) {\n    return @_null;\n  }\n"
    "  memset(w, 0, sizeof w);\n"
    "  @_enter(%Ax, state);\n";

static const char code_read_motion_rates[] =
    "  status = @_is_finite(x, %N) && @_input_is_finite(in) ? @_rates_at(%Arate, w, &a, x, in) : @_not_finite;\n"
    "  if (status != @_ok) {\n    return status;\n  }\n"
    "  memset(&own, 0, sizeof own);\n";

static const char code_read_motion_rotors[] = "  memcpy(own.rotor_speed, rate + %k, sizeof own.rotor_speed);\n";

static const char code_read_motion_end[] = "  memcpy(own.w, w, sizeof own.w);\n"
                                           "  memcpy(own.q_dot, rate + 10, %n * sizeof *rate);\n"
                                           "  if (!(@_is_finite(rate, %N) && @_is_finite(own.v, 3) && "
                                           "@_is_finite(own.w, 3))) {\n    return @_not_finite;\n  }\n"
                                           "  *motion = own;\n  return @_ok;\n}\n";

/* Velocity of O of a free body from that of the mass center. */
static const char code_read_origin[] = "\n/* v of O, body axes: R^T u - (w x c + c_dot)/m */\n"
                                       "static void @_origin(%M$ *v, const $ *w, const $ *x, const $ *q_dot)\n{\n%V"
                                       "  $ c[3], c_dot[3], u[3];\n"
                                       "  @_center(%Ac, x + 10);\n"
                                       "  @_center_rate(c_dot, x + 10, q_dot);\n"
                                       "  @_turn_back(u, x, x + 4);\n";

static const char code_read_rates[] =
    "\n@_status @_rates_eval(%M@_state *rate, const @_state *state, const @_input *in)\n{\n"
    "  $ x[%N], dot[%N], w[%w], a;\n"
    "  @_motion motion;\n"
    "  @_state own;\n"
    "  @_status status;\n"
    "  if (!rate || !state%Q) {\n    return @_null;\n  }\n"
    "  status = @_motion_eval(%A&motion, state, in);\n"
    "  if (status != @_ok) {\n    return status;\n  }\n"
    "  memset(w, 0, sizeof w);\n"
    "  @_enter(%Ax, state);\n";

static const char code_read_rates_at[] = "  status = @_rates_at(%Adot, w, &a, x, in);\n"
                                         "  status = status == @_ok && !@_is_finite(dot, %N) ? @_not_finite : status;\n"
                                         "  if (status != @_ok) {\n    return status;\n  }\n"
                                         "  memset(&own, 0, sizeof own);\n"
                                         "  @_turn(own.rho, x, motion.v);\n"
                                         "  memcpy(own.quat, dot, sizeof own.quat);\n"
                                         "  memcpy(own.u, dot + 4, sizeof own.u);\n"
                                         "  memcpy(own.L, dot + %l, sizeof own.L);\n"
                                         "  memcpy(own.q, dot + 10, %n * sizeof *dot);\n"
                                         "  memcpy(own.pi, dot + %p, %n * sizeof *dot);\n";

static const char code_read_rates_rotors[] = "  memcpy(own.rotor_angle, dot + %k, sizeof own.rotor_angle);\n"
                                             "  memcpy(own.rotor_momentum, dot + %g, sizeof own.rotor_momentum);\n";

/* The same with lines, of which the rates tell R^T u less it. */
static const char code_read_large_origin[] = "\n/* v of O, body axes: R^T u and what it has beside the mass center */\n"
                                             "static void @_origin(%M$ *v, const $ *w, const $ *x)\n{\n%V"
                                             "  @_turn_back(v, x, x + 4);\n"
                                             "  for (int i = 0; i < 3; i++) {\n    v[i] += w[3 + i];\n  }\n}\n";

static void code_write_origin(const code *w)
{
  char number[40];
  if (w->large) {
    code_template(w, code_read_large_origin);
    return;
  }
  code_template(w, code_read_origin);
  code_inverse_mass(number, w);
  for (int i = 0; i < 3; i++) {
    const int y = (i + 1) % 3, z = (i + 2) % 3;
    fprintf(w->out, "  v[%d] = u[%d] - %s * (w[%d] * c[%d] - w[%d] * c[%d] + c_dot[%d]);\n", i, i, number, y, z, z, y,
            i);
  }
  fputs("}\n", w->out);
}

/* Rates by gravity of a center want the place of the mass center of what flies. */
static void code_read_lead(const code *w)
{
  code_template(w, w->central && code_model.first == 0 ? "  @_lead(%Ax);\n" : "");
}

static void code_write_motion(const code *w)
{
  code_template(w, code_read_motion);
  code_read_lead(w);
  code_template(w, code_read_motion_rates);
  code_template(w, code_model.first == 0 && w->large ? "  @_origin(%Aown.v, w, x);\n"
                   : code_model.first == 0           ? "  @_origin(%Aown.v, w, x, rate + 10);\n"
                   : code_model.first == 3           ? ""
                                                     : "  memcpy(own.v, in ? in->v : @_nothing.v, sizeof own.v);\n");
  code_template(w, w->rotors > 0 ? code_read_motion_rotors : "");
  code_template(w, code_read_motion_end);
  code_template(w, code_read_rates);
  code_read_lead(w);
  code_template(w, code_read_rates_at);
  code_template(w, w->rotors > 0 ? code_read_rates_rotors : "");
  if (w->vary & CODE_MASS) {
    code_template(w, "  for (int i = 0; i < 3; i++) {\n    own.L[i] *= model->mass;\n  }\n"
                     "  for (int k = 0; k < %n; k++) {\n    own.pi[k] *= model->mass;\n  }\n");
  }
  code_template(w, "  if (!(@_is_finite(own.rho, 3) && @_is_finite(own.L, 3) && @_is_finite(own.pi, %n))) {\n"
                   "    return @_not_finite;\n  }\n  *rate = own;\n  return @_ok;\n}\n");
}

static const char code_read_energy[] =
    "\n/* T = 1/2 (w.h + q_dot.pi + m u.u + speeds times momenta of rotors), homogeneous of degree 2 in the momenta;\n"
    "   gravity as E8.16 */\n"
    "@_status @_energy_eval(%M@_energy *energy, const @_state *state)\n{\n"
    "  $ x[%N], rate[%N], w[%w], c[3], moment[3], a, kinetic;\n"
    "  @_energy own;\n"
    "  @_status status;\n";

/* Momenta that are given are those of the state. */
static const char code_read_energy_given[] =
    "  @_input held;\n"
    "  const @_input *const in = &held;\n"
    "  memset(&held, 0, sizeof held);\n"
    "  if (state) {\n"
    "    memcpy(held.rotor_motor, state->rotor_momentum, sizeof held.rotor_motor);\n"
    "  }\n";

static const char code_read_energy_rates[] = "  if (!energy || !state%Q) {\n    return @_null;\n  }\n"
                                             "  memset(w, 0, sizeof w);\n"
                                             "  @_enter(%Ax, state);\n";

static const char code_read_energy_call[] = "  status = @_is_finite(x, %N) ? @_rates_at(%Arate, w, &a, x, ";

static const char code_read_energy_kinetic[] =
    ") : @_not_finite;\n"
    "  if (status != @_ok) {\n    return status;\n  }\n"
    "  @_center(%Ac, x + 10);\n"
    "  @_turn(moment, x, c);\n"
    "  kinetic = w[0] * x[7] + w[1] * x[8] + w[2] * x[9];\n"
    "  for (int k = 0; k < %n; k++) {\n    kinetic += rate[10 + k] * x[%p + k];\n  }\n";

static const char code_read_energy_rotors[] =
    "  for (int r = 0; r < %R; r++) {\n    kinetic += rate[%k + r] * x[%g + r];\n  }\n";

static void code_write_energy(const code *w)
{
  static double K[FB_MAX_MODES][FB_MAX_MODES];
  const fb_body *const body = code_model.body;
  const double fixed = w->vary & CODE_HUB ? 1.0 : (double)body->mass;
  const code_value mass = code_factor_of(w, CODE_HUB, "body");
  code_sum s;
  code_template(w, code_read_energy);
  code_template(w, code_rotors_given(body) ? code_read_energy_given : "");
  code_template(w, code_read_energy_rates);
  code_read_lead(w);
  code_template(w, code_read_energy_call);
  code_template(w, code_rotors_given(body) ? "in" : "NULL");
  code_template(w, code_read_energy_kinetic);
  code_template(w, w->rotors > 0 ? code_read_energy_rotors : "");
  code_begin(&s);
  code_add_one(&s, 0.5, code_variable("kinetic"));
  for (int i = 0; i < 3; i++) {
    if (w->vary & CODE_HUB) {
      fprintf(w->out, "  w[%d] = x[%d] * x[%d];\n", i, 4 + i, 4 + i);
      code_add(&s, 0.5, mass, code_variable("w[%d]", i));
    } else {
      code_add(&s, 0.5 * fixed, code_variable("x[%d]", 4 + i), code_variable("x[%d]", 4 + i));
    }
  }
  code_assign(w, &s, "own.kinetic");
  code_read_sparse(K, &body->K, w->n);
  code_begin(&s);
  for (int a = 0; a < w->n; a++) {
    for (int b = 0; b <= a; b++) {
      code_add(&s, (a == b ? 0.5 : 1.0) * K[a][b], code_variable("x[%d]", 10 + a), code_variable("x[%d]", 10 + b));
    }
  }
  code_assign(w, &s, "own.strain");
  code_begin(&s);
  for (int i = 0; i < 3; i++) {
    const double g = code_gravity(i);
    code_add_one(&s, w->central && code_model.first == 0 ? 0.0 : -g,
                 code_variable("moment[%d]", i)); /* x has its place */
    code_add(&s, -g * fixed, code_variable("x[%d]", code_place(w, 'r') + i), mass);
  }
  code_assign(w, &s, "own.gravity");
  if (w->central) {
    code_template(
        w, "  status = @_potential(%A&a, x);\n  if (status != @_ok) {\n    return status;\n  }\n  own.gravity += a;\n");
  }
  if (w->vary & (CODE_STIFFNESS | CODE_MASS)) {
    fputs("  own.strain *= model->stiffness;\n", w->out);
  }
  if (w->vary & CODE_MASS) {
    fputs("  own.kinetic *= model->mass;\n  own.strain *= model->mass;\n  own.gravity *= model->mass;\n", w->out);
  }
  code_template(w, "  (void)moment;\n  w[0] = own.kinetic;\n  w[1] = own.strain;\n  w[2] = own.gravity;\n"
                   "  if (!@_is_finite(w, 3)) {\n    return @_not_finite;\n  }\n  *energy = own;\n  return @_ok;\n}\n");
}

/* The end of a node's motion by that of O: x_O, v_O and w_O, q of its axes, in body axes s the place, u, phi the displacement and
   rotation. */
static const char code_read_node[] =
    "  for (int i = 0; i < 3; i++) {\n    s[i] += u[i];\n  }\n"
    "  share = `1` / (`1` + `0.25` * (phi[0] * phi[0] + phi[1] * phi[1] + phi[2] * phi[2]));\n"
    "  for (int i = 0; i < 3; i++) {\n"
    "    const int y = i < 2 ? i + 1 : 0, z = i > 0 ? i - 1 : 2;\n"
    "    v[i] = v_O[i] + w_O[y] * s[z] - w_O[z] * s[y] + u_dot[i];\n"
    "    w[i] = w_O[i] + share * (phi_dot[i] + `0.5` * (phi[y] * phi_dot[z] - phi[z] * phi_dot[y]));\n"
    "  }\n"
    "  @_turn(own.position, q, s);\n"
    "  @_turn(own.velocity, q, v);\n"
    "  @_turn(own.angular_rate, q, w);\n"
    "  share = sqrt~(share);\n"
    "  for (int i = 0; i < 3; i++) {\n"
    "    own.position[i] += x_O[i];\n"
    "    phi[i] *= `0.5`;\n  }\n"
    "  own.quat[0] = share * (q[0] - q[1] * phi[0] - q[2] * phi[1] - q[3] * phi[2]);\n"
    "  own.quat[1] = share * (q[1] + q[0] * phi[0] + q[2] * phi[2] - q[3] * phi[1]);\n"
    "  own.quat[2] = share * (q[2] + q[0] * phi[1] + q[3] * phi[0] - q[1] * phi[2]);\n"
    "  own.quat[3] = share * (q[3] + q[0] * phi[2] + q[1] * phi[1] - q[2] * phi[0]);\n"
    "  if (!(@_is_finite(own.position, 3) && @_is_finite(own.quat, 4) && @_is_finite(own.velocity, 3) &&\n"
    "        @_is_finite(own.angular_rate, 3))) {\n    return @_not_finite;\n  }\n"
    "  *out = own;\n  return @_ok;\n}\n";

/* The end with lines: by a quaternion and an angular velocity. */
static const char code_read_large_node[] =
    "  for (int i = 0; i < 3; i++) {\n    s[i] += u[i];\n  }\n"
    "  for (int i = 0; i < 3; i++) {\n"
    "    const int y = i < 2 ? i + 1 : 0, z = i > 0 ? i - 1 : 2;\n"
    "    v[i] = v_O[i] + w_O[y] * s[z] - w_O[z] * s[y] + u_dot[i];\n"
    "    spin[i] += w_O[i];\n"
    "  }\n"
    "  @_turn(own.position, q, s);\n"
    "  @_turn(own.velocity, q, v);\n"
    "  @_turn(own.angular_rate, q, spin);\n"
    "  for (int i = 0; i < 3; i++) {\n    own.position[i] += x_O[i];\n  }\n"
    "  own.quat[0] = q[0] * turn[0] - q[1] * turn[1] - q[2] * turn[2] - q[3] * turn[3];\n"
    "  own.quat[1] = q[1] * turn[0] + q[0] * turn[1] + q[2] * turn[3] - q[3] * turn[2];\n"
    "  own.quat[2] = q[2] * turn[0] + q[0] * turn[2] + q[3] * turn[1] - q[1] * turn[3];\n"
    "  own.quat[3] = q[3] * turn[0] + q[0] * turn[3] + q[1] * turn[2] - q[2] * turn[1];\n"
    "  if (!(sound && @_is_finite(own.position, 3) && @_is_finite(own.quat, 4) && @_is_finite(own.velocity, 3) &&\n"
    "        @_is_finite(own.angular_rate, 3))) {\n    return sound ? @_not_finite : @_range;\n  }\n"
    "  *out = own;\n  return @_ok;\n}\n";

static int code_write_nodes(const code *w)
{
  const fb_body *const body = code_model.body;
  int good = 1;
  char number[40];
  for (int k = 1; k < body->n_node; k++) {
    good = good &&
           code_write_pruned(w, w->large && body->node[k].line.line > 0 ? code_write_line_node : code_write_node, k);
  }
  code_template(w, "\n/* E8.20 */\n@_status @_node_eval(%M@_node *out, const @_state *state, const @_motion *motion, "
                   "int node)\n{\n");
  code_template(w, "  static const $ place[][3] = {");
  for (int k = 0; k < body->n_node; k++) {
    for (int i = 0; i < 3; i++) {
      code_number(number, w, (double)body->node[k].r[i]);
      fprintf(w->out, "%s%s%s", i == 0 ? (k == 0 ? "{" : ", {") : ", ", number, i == 2 ? "}" : "");
    }
  }
  code_template(
      w,
      w->large
          ? "};\n  $ s[3], v[3], u[3] = {`0`}, turn[4] = {`1`}, u_dot[3] = {`0`}, spin[3] = {`0`};\n  int sound = 1;\n"
          : "};\n  $ s[3], v[3], w[3], u[3] = {`0`}, phi[3] = {`0`}, u_dot[3] = {`0`}, phi_dot[3] = {`0`}, share;\n");
  code_template(w, "  const $ *q, *x_O, *v_O, *w_O;\n");
  code_template(w, "  $ x[%N];\n"
                   "  @_node own;\n"
                   "  if (!out || !state || !motion%Q) {\n    return @_null;\n  }\n");
  fprintf(w->out, "  if (node < 0 || node >= %d) {\n", body->n_node);
  code_template(w, "    return @_value;\n  }\n  @_enter(%Ax, state);\n"
                   "  if (!@_is_finite(x, %N)) {\n    return @_not_finite;\n  }\n"
                   "  q = state->quat;\n  memcpy(s, place[node], sizeof s);\n");
  code_template(w, "  x_O = state->rho;\n  v_O = motion->v;\n  w_O = motion->w;\n");
  for (int k = 1; k < body->n_node; k++) {
    fprintf(w->out, "  if (node == %d) {\n", k);
    code_template(w, w->large && body->node[k].line.line > 0 ? "    sound = @_node_" : "    @_node_");
    fprintf(w->out,
            w->large ? "%d(u, turn, u_dot, spin, state->q, motion->q_dot);\n  }\n"
                     : "%d(u, phi, u_dot, phi_dot, state->q, motion->q_dot);\n  }\n",
            k);
  }
  code_template(w, w->large ? code_read_large_node : code_read_node);
  return good;
}

/* All of it. */
static int code_write_read(const code *w)
{
  int good = 1;
  if (code_model.first == 0 && !w->large) {
    good = code_write_pruned(w, code_write_center_rate, 0);
  }
  if (code_model.first == 0) {
    code_write_origin(w);
  }
  code_write_motion(w);
  if (code_model.first < 6) {
    code_write_energy(w);
  }
  return code_write_nodes(w) && good;
}
#endif
