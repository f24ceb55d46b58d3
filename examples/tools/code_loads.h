/* code_loads.h - loads at nodes as what acts on the step of code.h: a force and a torque at each node that `reduce --loads`
   names, body axes, on the deformed body (E8.15). */
#ifndef CODE_LOADS_H
#define CODE_LOADS_H
#include "code_model.h"
#include "code_text.h"

static struct code_loads { /* of each node that has a load, as written */
  int at[FB_MAX_NODES];    /* bits of code_choice.loads: is it one? */
  code_value force[FB_MAX_NODES][3], torque[FB_MAX_NODES][3], arm[FB_MAX_NODES][3], bent[FB_MAX_NODES][3];
  code_value move[FB_MAX_NODES][3][FB_MAX_MODES], turn[FB_MAX_NODES][3][FB_MAX_MODES]; /* by rates of the coordinates */
} code_loads;

typedef char code_nodes_are_bits[FB_MAX_NODES <= 32 ? 1 : -1];

static void code_loads_choose(unsigned nodes)
{
  for (int k = 0; k < FB_MAX_NODES; k++) {
    code_loads.at[k] = (int)(nodes >> k & 1u);
  }
}

static int code_loads_any(void)
{
  int any = 0;
  for (int k = 0; k < FB_MAX_NODES; k++) {
    any |= code_loads.at[k];
  }
  return any;
}

/* What cannot bear loads at nodes, with what would be right; NULL: nothing. */
static inline const char *code_loads_refusal(const fb_body *body, unsigned nodes)
{
  return body->effects & FB_EFFECT_LARGE_DEFLECTION && nodes ? "effects large has none: choose effects up to full"
                                                             : NULL;
}

/* Members of what acts. */
static void code_write_load_types(const code *w)
{
  for (int k = 0; k < FB_MAX_NODES; k++) {
    if (code_loads.at[k]) {
      fprintf(w->out, "  %s force_%d[3], torque_%d[3]; /* [N], [N m] at node %d, body axes */\n", code_real(w), k, k,
              k);
    }
  }
}

/* Text for each node with a load, in which # is its number. */
static void code_write_of_loads(const code *w, const char *text)
{
  for (int k = 0; k < FB_MAX_NODES; k++) {
    for (const char *c = text; *c && code_loads.at[k]; c++) {
      const char piece[2] = {*c, '\0'};
      if (*c == '#') {
        fprintf(w->out, "%d", k);
      } else if (*c == '@') {
        code_template(w, "@_is_finite");
      } else {
        fputs(piece, w->out);
      }
    }
  }
}

/* x = r + psi q + 1/2 chi q q along axis i, and its slopes by the coordinates (r, chi: NULL: zero). */
static void code_write_load_field(const code *w, code_value *x, code_value slope[FB_MAX_MODES], const char *name, int i,
                                  const fb_real *r, const fb_real *psi, const fb_real *chi)
{
  code_sum s;
  for (int a = 0; a < w->n; a++) {
    code_begin(&s);
    code_add_one(&s, (double)psi[3 * a + i], code_constant(1.0));
    for (int b = 0; b < w->n && chi; b++) {
      code_add_one(&s, (double)chi[(a > b ? 3 * (a * (a + 1) / 2 + b) : 3 * (b * (b + 1) / 2 + a)) + i],
                   code_variable("q_%d", b));
    }
    slope[a] = code_end(w, &s, code_variable("%s_%c_%d", name, 'x' + i, a));
  }
  code_begin(&s);
  code_add_one(&s, r ? (double)r[i] : 0.0, code_constant(1.0));
  for (int a = 0; a < w->n; a++) {
    code_add_one(&s, 0.5 * (double)psi[3 * a + i], code_variable("q_%d", a));
    code_add(&s, 0.5, slope[a], code_variable("q_%d", a));
  }
  *x = code_end(w, &s, code_variable("%s_at_%c", name, 'x' + i));
}

/* The torque that the slopes of the rotation vector phi bear: J_phi^T T = t^T (T + 1/2 T x phi) / (1 + 1/4 phi.phi). */
static void code_write_bent_torque(const code *w, int k, const code_value phi[3])
{
  const code_value *const T = code_loads.torque[k];
  code_value share;
  code_sum s;
  code_begin(&s);
  code_add_one(&s, 1.0, code_constant(1.0));
  for (int i = 0; i < 3; i++) {
    code_add(&s, 0.25, phi[i], phi[i]);
  }
  share = code_end(w, &s, code_variable("n%d_bent", k));
  if (!code_is_constant(&share)) {
    code_template(w, w->indent == 4 ? "    const $ n" : "  const $ n");
    fprintf(w->out, "%d_share = ", k);
    code_template(w, "`1` / ");
    fprintf(w->out, "n%d_bent;\n", k);
    share = code_variable("n%d_share", k);
  }
  for (int i = 0; i < 3; i++) {
    const int y = (i + 1) % 3, z = (i + 2) % 3;
    code_value turned;
    code_begin(&s);
    code_add_one(&s, 1.0, T[i]);
    code_add(&s, 0.5, T[y], phi[z]);
    code_add(&s, -0.5, T[z], phi[y]);
    turned = code_end(w, &s, code_variable("n%d_M_%c", k, 'x' + i));
    code_begin(&s);
    code_add(&s, 1.0, share, turned);
    code_loads.bent[k][i] = code_end(w, &s, code_variable("n%d_B_%c", k, 'x' + i));
  }
}

/* Forces, torques, places and slopes of all nodes with a load; act: the variable of what acts. */
static void code_write_node_loads(const code *w, const char *act)
{
  const fb_body *const body = code_model.body;
  const code_value share = code_factor_of(w, CODE_MASS, "share");
  for (int k = 0; k < body->n_node; k++) {
    const fb_node *const node = &body->node[k];
    const fb_real *chi = NULL, *chi_theta = NULL;
    code_value phi[3];
    char move[16], turn[16];
#if FBI_WITH_QUADRATIC
    if (body->effects & (FB_EFFECT_SPIN_STIFFENING | FB_EFFECT_ACCELERATION_STIFFENING)) {
      chi = node->chi;
      chi_theta = node->chi_theta;
    }
#endif
    snprintf(move, sizeof move, "n%d_u", k);
    snprintf(turn, sizeof turn, "n%d_phi", k);
    for (int i = 0; i < 3 && code_loads.at[k]; i++) {
      code_sum s;
      code_begin(&s);
      code_add(&s, 1.0, share, code_variable("%s->force_%d[%d]", act, k, i));
      code_loads.force[k][i] = code_end(w, &s, code_variable("n%d_F_%c", k, 'x' + i));
      code_begin(&s);
      code_add(&s, 1.0, share, code_variable("%s->torque_%d[%d]", act, k, i));
      code_loads.torque[k][i] = code_end(w, &s, code_variable("n%d_T_%c", k, 'x' + i));
      code_write_load_field(w, &code_loads.arm[k][i], code_loads.move[k][i], move, i, node->r, node->psi, chi);
      code_write_load_field(w, &phi[i], code_loads.turn[k][i], turn, i, NULL, node->theta, chi_theta);
    }
    if (code_loads.at[k]) {
      code_write_bent_torque(w, k, phi);
    }
  }
}

/* s += forces along axis i */
static void code_add_node_forces(code_sum *s, int i)
{
  for (int k = 0; k < FB_MAX_NODES; k++) {
    if (code_loads.at[k]) {
      code_add_one(s, 1.0, code_loads.force[k][i]);
    }
  }
}

/* s += torques about O, axis i */
static void code_add_node_torques(code_sum *s, int i)
{
  const int y = (i + 1) % 3, z = (i + 2) % 3;
  for (int k = 0; k < FB_MAX_NODES; k++) {
    if (code_loads.at[k]) {
      code_add_one(s, 1.0, code_loads.torque[k][i]);
      code_add(s, 1.0, code_loads.arm[k][y], code_loads.force[k][z]);
      code_add(s, -1.0, code_loads.arm[k][z], code_loads.force[k][y]);
    }
  }
}

/* s += their generalized force on coordinate a */
static void code_add_node_modal(code_sum *s, int a)
{
  for (int k = 0; k < FB_MAX_NODES; k++) {
    for (int i = 0; i < 3 && code_loads.at[k]; i++) {
      code_add(s, 1.0, code_loads.move[k][i][a], code_loads.force[k][i]);
      code_add(s, 1.0, code_loads.turn[k][i][a], code_loads.bent[k][i]);
    }
  }
}
#endif
