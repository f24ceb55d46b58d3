/* code_rotors.h - rotors inside a body (fb_rotor) in the words of code.h: E8.41 to E8.43 and what they add to the step
   limit, E11.46. The body is that of code_model, its names those of code_of_names. */
#ifndef CODE_ROTORS_H
#define CODE_ROTORS_H
#include "code_loads.h"
#include "code_model.h"
#include "code_text.h"

/* What an evaluation has written of the rotors of a body. Those on nodes that modes move turn with them: by the rotation
   parameters phi, whose slopes are turn, J^T x = turn^T B(x) with B(x) = (x + 1/2 x x phi)/(1 + 1/4 phi.phi). */
typedef struct code_rotors {
  code_value axis[FB_MAX_ROTORS][3], momentum[FB_MAX_ROTORS], speed[FB_MAX_ROTORS];
  code_value phi[FB_MAX_ROTORS][3], share[FB_MAX_ROTORS], turn[FB_MAX_ROTORS][3][FB_MAX_MODES];
  code_value bent[FB_MAX_ROTORS][3];             /* B of the axis */
  code_value slope[FB_MAX_ROTORS][FB_MAX_MODES]; /* J^T axis */
} code_rotors;

static code_rotors code_rotor;

/* What of the rotors of a body cannot be written, with what would be right; NULL: nothing. */
static inline const char *code_rotors_refusal(const fb_body *body)
{
  for (int r = 0; r < body->n_rotor; r++) {
    const fb_rotor *const rotor = &body->rotor[r];
    if (fbi_is_unbalanced(rotor)) {
      return "a rotor with an imbalance: choose one without, and its force as a load at a node";
    }
    if (rotor->moves && body->effects & FB_EFFECT_LARGE_DEFLECTION) {
      return "a rotor on a line of effects large: put it on the hub, or choose effects up to full";
    }
  }
  return NULL;
}

/* Is the momentum of one given? */
static int code_rotors_given(const fb_body *body)
{
  int given = 0;
  for (int r = 0; r < body->n_rotor; r++) {
    given |= body->rotor[r].given;
  }
  return given;
}

/* out = B(x) of rotor r */
static void code_write_rotor_bent(const code *w, code_value out[3], const code_value x[3], const char *name, int r)
{
  const code_value *const phi = code_rotor.phi[r];
  code_sum s;
  for (int i = 0; i < 3; i++) {
    const int y = (i + 1) % 3, z = (i + 2) % 3;
    code_value sum;
    code_begin(&s);
    code_add_one(&s, 1.0, x[i]);
    code_add(&s, 0.5, x[y], phi[z]);
    code_add(&s, -0.5, x[z], phi[y]);
    sum = code_end(w, &s, code_variable("r%d_%ss_%c", r, name, 'x' + i));
    code_begin(&s);
    code_add(&s, 1.0, code_rotor.share[r], sum);
    out[i] = code_end(w, &s, code_variable("r%d_%s_%c", r, name, 'x' + i));
  }
}

/* out = a x b, by name */
static void code_write_rotor_cross(const code *w, code_value out[3], const code_value a[3], const code_value b[3],
                                   const char *name, int r)
{
  code_sum s;
  for (int i = 0; i < 3; i++) {
    const int y = (i + 1) % 3, z = (i + 2) % 3;
    code_begin(&s);
    code_add(&s, 1.0, a[y], b[z]);
    code_add(&s, -1.0, a[z], b[y]);
    out[i] = code_end(w, &s, code_variable("r%d_%s_%c", r, name, 'x' + i));
  }
}

/* Rotation parameters of the node of rotor r, with 1/(1 + 1/4 phi.phi). */
static void code_write_rotor_node(const code *w, int r)
{
  const fb_body *const body = code_model.body;
  const fb_node *const node = &body->node[body->rotor[r].node];
  const fb_real *chi = NULL;
  char name[16];
  code_sum s;
#if FBI_WITH_QUADRATIC
  if (body->effects & (FB_EFFECT_SPIN_STIFFENING | FB_EFFECT_ACCELERATION_STIFFENING)) {
    chi = node->chi_theta;
  }
#endif
  snprintf(name, sizeof name, "r%d_phi", r);
  code_begin(&s);
  code_add_one(&s, 1.0, code_constant(1.0));
  for (int i = 0; i < 3; i++) {
    code_value *const phi = &code_rotor.phi[r][i];
    code_write_load_field(w, phi, code_rotor.turn[r][i], name, i, NULL, node->theta, chi);
    code_add(&s, 0.25, *phi, *phi);
  }
  code_rotor.share[r] = code_end(w, &s, code_variable("r%d_long", r));
  if (!code_is_constant(&code_rotor.share[r])) {
    fprintf(w->out, "%*sconst %s %s = ", w->indent, "", code_real(w), code_variable("r%d_share", r).name);
    code_template(w, "`1` / ");
    fprintf(w->out, "%s;\n", code_rotor.share[r].name);
    code_rotor.share[r] = code_variable("r%d_share", r);
  }
}

/* The axis of rotor r, body axes: a + (phi x a + 1/2 phi x (phi x a))/(1 + 1/4 phi.phi); and J^T of it. */
static void code_write_rotor_axis(const code *w, int r)
{
  const fb_rotor *const rotor = &code_model.body->rotor[r];
  code_value once[3], twice[3], sum;
  code_sum s;
  for (int i = 0; i < 3; i++) {
    const double a = (double)rotor->axis[i];
    code_rotor.axis[r][i] = code_constant(fabs(a) <= 8.0 * DBL_EPSILON ? 0.0 : code_snap(a));
    code_rotor.bent[r][i] = code_rotor.phi[r][i] = code_constant(0.0);
  }
  for (int a = 0; a < code_model.n; a++) {
    code_rotor.slope[r][a] = code_constant(0.0);
  }
  if (!rotor->moves) {
    return;
  }
  code_write_rotor_node(w, r);
  code_write_rotor_cross(w, once, code_rotor.phi[r], code_rotor.axis[r], "t", r);
  code_write_rotor_cross(w, twice, code_rotor.phi[r], once, "tt", r);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, once[i]);
    code_add_one(&s, 0.5, twice[i]);
    sum = code_end(w, &s, code_variable("r%d_more_%c", r, 'x' + i));
    code_begin(&s);
    code_add_one(&s, 1.0, code_rotor.axis[r][i]);
    code_add(&s, 1.0, code_rotor.share[r], sum);
    code_rotor.axis[r][i] = code_end(w, &s, code_variable("r%d_axis_%c", r, 'x' + i));
  }
  code_write_rotor_bent(w, code_rotor.bent[r], code_rotor.axis[r], "bent", r);
  for (int a = 0; a < code_model.n; a++) {
    code_begin(&s);
    for (int i = 0; i < 3; i++) {
      code_add(&s, 1.0, code_rotor.turn[r][i][a], code_rotor.bent[r][i]);
    }
    code_rotor.slope[r][a] = code_end(w, &s, code_variable("r%d_slope_%d", r, a));
  }
}

/* Axes and momenta of all rotors, whose momenta begin at a place of the vector x; motor: member of what acts, where `when`. */
static void code_write_rotors(const code *w, int place, const char *when, const char *motor)
{
  const fb_body *const body = code_model.body;
  fputs(body->n_rotor > 0 ? "\n  /* E8.41: momenta and axes of rotors, body axes */\n" : "", w->out);
  for (int r = 0; r < body->n_rotor; r++) {
    code_rotor.momentum[r] = code_variable("r%d_h", r);
    fprintf(w->out, "%*sconst %s %s = ", w->indent, "", code_real(w), code_variable("r%d_motor", r).name);
    fprintf(w->out, "%s ? in->%s[%d] : ", when, motor, r);
    code_template(w, "%z;\n");
    fprintf(w->out, "%*sconst %s %s = ", w->indent, "", code_real(w), code_rotor.momentum[r].name);
    if (body->rotor[r].given) {
      fprintf(w->out, "%s;\n", code_variable("r%d_motor", r).name);
    } else {
      fprintf(w->out, "x[%d];\n", place + r);
    }
    code_write_rotor_axis(w, r);
  }
}

/* s += sign times the momenta of the rotors about axis i of the body */
static void code_add_rotors(code_sum *s, double sign, int i)
{
  for (int r = 0; r < code_model.body->n_rotor; r++) {
    code_add(s, sign, code_rotor.axis[r][i], code_rotor.momentum[r]);
  }
}

static code_value code_pi(int a)
{
  return code_variable("p_%d", a);
}

/* Momenta of the modes without those of rotors, E8.41. */
static void code_write_own_pi(const code *w, code_value pi[FB_MAX_MODES])
{
  for (int a = 0; a < w->n; a++) {
    code_sum s;
    code_begin(&s);
    code_add_one(&s, 1.0, code_pi(a));
    for (int r = 0; r < code_model.body->n_rotor; r++) {
      code_add(&s, -1.0, code_rotor.slope[r][a], code_rotor.momentum[r]);
    }
    pi[a] = code_end(w, &s, code_variable("own_%d", a));
  }
}

/* E8.43 of a rotor that modes move: h (J^T (axis x w) + J_dot^T axis), added to the forces on the modes. */
static void code_write_rotor_force(const code *w, code_sum *force, int r, const code_value *V, const code_value *q_dot)
{
  const fb_body *const body = code_model.body;
  const fb_node *const node = &body->node[body->rotor[r].node];
  const code_value *const phi = code_rotor.phi[r];
  code_value phi_dot[3], shrink, across[3], by_w[3], by_rate[3], Z[3], G[3];
  const int quadratic =
      (body->effects & (FB_EFFECT_SPIN_STIFFENING | FB_EFFECT_ACCELERATION_STIFFENING)) != 0 && FBI_WITH_QUADRATIC;
  code_sum s, t;
  code_begin(&t);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    for (int a = 0; a < w->n; a++) {
      code_add(&s, 1.0, code_rotor.turn[r][i][a], q_dot[a]);
    }
    phi_dot[i] = code_end(w, &s, code_variable("r%d_rate_%c", r, 'x' + i));
    code_add(&t, 0.5, phi[i], phi_dot[i]);
  }
  shrink = code_end(w, &t, code_variable("r%d_shrink", r));
  code_write_rotor_cross(w, across, code_rotor.axis[r], V + 3, "aw", r);
  code_write_rotor_bent(w, by_w, across, "Z", r);
  code_write_rotor_cross(w, by_rate, code_rotor.axis[r], phi_dot, "ar", r);
  for (int i = 0; i < 3; i++) {
    code_value sum;
    code_begin(&s);
    code_add_one(&s, 0.5, by_rate[i]);
    code_add(&s, -1.0, shrink, code_rotor.bent[r][i]);
    sum = code_end(w, &s, code_variable("r%d_Zs_%c_0", r, 'x' + i));
    code_begin(&s);
    code_add_one(&s, 1.0, by_w[i]);
    code_add(&s, 1.0, code_rotor.share[r], sum);
    sum = code_end(w, &s, code_variable("r%d_Z_%c_1", r, 'x' + i));
    code_begin(&s);
    code_add(&s, 1.0, code_rotor.momentum[r], sum);
    Z[i] = code_end(w, &s, code_variable("r%d_hZ_%c", r, 'x' + i));
    code_begin(&s);
    code_add(&s, 1.0, code_rotor.momentum[r], code_rotor.bent[r][i]);
    G[i] = code_end(w, &s, code_variable("r%d_hB_%c", r, 'x' + i));
  }
  for (int a = 0; a < w->n; a++) {
    for (int i = 0; i < 3; i++) {
      code_add(&force[a], 1.0, code_rotor.turn[r][i][a], Z[i]);
      code_begin(&s);
#if FBI_WITH_QUADRATIC
      for (int b = 0; b < w->n && quadratic; b++) {
        code_add_one(&s, (double)node->chi_theta[fbi_pair(a, b) + i], q_dot[b]);
      }
#endif
      if (s.n > 0) {
        code_add(&force[a], 1.0, G[i], code_end(w, &s, code_variable("r%d_t_%d_%c", r, a, 'x' + i)));
      }
    }
  }
  (void)node, (void)quadratic;
}

/* Speeds of the rotors, and forces on the modes that move them: E8.43. */
static void code_write_rotor_speeds(const code *w, code_sum *force, const code_value *V, const code_value *q_dot)
{
  const fb_body *const body = code_model.body;
  code_sum s;
  fputs(body->n_rotor > 0 ? "\n  /* E8.43: speeds of rotors */\n" : "", w->out);
  for (int r = 0; r < body->n_rotor; r++) {
    code_begin(&s);
    code_add_one(&s, 1.0 / (double)body->rotor[r].inertia, code_rotor.momentum[r]);
    for (int i = 0; i < 3; i++) {
      code_add(&s, -1.0, code_rotor.axis[r][i], V[3 + i]);
    }
    for (int a = 0; a < w->n; a++) {
      code_add(&s, -1.0, code_rotor.slope[r][a], q_dot[a]);
    }
    code_rotor.speed[r] = code_variable("r%d_speed", r);
    code_declare(w, &s, code_rotor.speed[r].name);
    if (body->rotor[r].moves) {
      code_write_rotor_force(w, force, r, V, q_dot);
    }
  }
}

/* Rates of the angles and momenta of rotors, which begin at these places: E8.43, friction E9.28. */
static void code_write_rotor_rates(const code *w, int angle, int momentum)
{
  const fb_body *const body = code_model.body;
  for (int r = 0; r < body->n_rotor; r++) {
    const fb_rotor *const rotor = &body->rotor[r];
    const code_value speed = code_rotor.speed[r], rub = code_variable("r%d_rub", r);
    char target[32], text[200];
    code_sum s;
    code_begin(&s);
    code_add_one(&s, 1.0, speed);
    snprintf(target, sizeof target, "rate[%d]", angle + r);
    code_assign(w, &s, target);
    code_begin(&s);
    if (!rotor->given) {
      code_add_one(&s, 1.0, code_variable("r%d_motor", r));
      code_add_one(&s, -(double)rotor->damping, speed);
    }
    if (!rotor->given && rotor->friction > FB_R(0.0)) {
      snprintf(text, sizeof text, "  const $ %s = `%.17g` / sqrt~(%s * %s + `%.17g`);\n", rub.name,
               (double)rotor->friction, speed.name, speed.name,
               (double)rotor->friction_speed * (double)rotor->friction_speed);
      code_template(w, text);
      code_add(&s, -1.0, rub, speed);
    }
    snprintf(target, sizeof target, "rate[%d]", momentum + r);
    code_assign(w, &s, target);
  }
}

/* E11.46: what the rotors add to the rotation that a step has to resolve; more: what else does. */
static void code_write_nutation(const code *w, const char *target, code_value more)
{
  const fb_body *const body = code_model.body;
  code_sum s;
  code_begin(&s);
  for (int r = 0; r < body->n_rotor; r++) {
    const code_value size = code_variable("r%d_size", r);
    fprintf(w->out, "%*sconst %s %s = ", w->indent, "", code_real(w), size.name);
    code_template(w, "fabs~(");
    fprintf(w->out, "%s);\n", code_rotor.momentum[r].name);
    code_add_one(&s, 0.5 * (double)body->rotor[r].mobility, size);
    code_add_one(&s, (double)body->rotor[r].rate, code_constant(1.0));
  }
  code_add_one(&s, 1.0, more);
  code_assign(w, &s, target);
}

/* ---- what a step keeps of them */

static const char code_rotor_settle[] =
    "\n/* Angle of a rotor within half a turn */\n"
    "static void @_settle($ *angle)\n{\n"
    "  static const $ known[2] = {`0`, `1`}, half[2] = {`0.5`, `-0.5`};\n"
    "  const $ turns = *angle / `6.283185307179586477`;\n"
    "  const $ whole = known[fabs~(turns) < `1e9`] * turns;\n"
    "  *angle -= `6.283185307179586477` * ($)(int)(whole + half[whole < `0`]);\n}\n";

/* Of all lanes by that of one body. */
static void code_write_settle(const code *w)
{
  if (!w->lanes) {
    code_template(w, code_rotor_settle);
    return;
  }
  code_template(w, "\nstatic void @_settle($ *angle)\n{\n");
  fprintf(w->out, "  for (int k = 0; k < %s_LANES; k++) {\n", w->name);
  code_template(w, "    %s own = (*angle)[k];\n");
  fprintf(w->out, "    %s_settle(&own);\n    (*angle)[k] = own;\n  }\n}\n", w->name);
}
#endif
