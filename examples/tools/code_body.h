/* code_body.h - declarations of the step of a single body, whose functions trace/ writes: reduce --code. Parameters may stay
   variable in it, factors of what the description says. */
#ifndef CODE_BODY_H
#define CODE_BODY_H
#include "../common/output.h"
#include "code.h"
#include <float.h>

/* Bits of code.vary and trace_choice.vary. */
enum {
  CODE_STIFFNESS = 1,
  CODE_DAMPING = 2,
  CODE_MASS = 4, /* of all but the hub */
  CODE_HUB_MASS = 8,
  CODE_HUB_INERTIA = 16,
  CODE_HUB = 28 /* what changes the hub relative to the rest */
};

typedef struct code_choice { /* what is to be written */
  const char *name;
  int single, vary, lanes, places;
  node_set loads; /* the nodes that have a load */
} code_choice;

static const struct code_parameter {
  const char *name, *what;
} code_parameters[] = {{"stiffness", "of K"},
                       {"damping", "of the damping ratios; from 0"},
                       {"mass", "of all but the hub"},
                       {"hub_mass", "of the hub; its mass center stays"},
                       {"hub_inertia", "of the hub, about its mass center"}};

enum { CODE_PARAMETERS = sizeof code_parameters / sizeof *code_parameters };

static struct code_body { /* what is written */
  const fb_body *body;
  const code_choice *choice;
} code_body;

/* Bits of the names in a list with commas; 0: one is no parameter, or there twice. */
static int code_vary_read(const char *list)
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

/* What of the choice a body has not, with what would be right; NULL: nothing. */
static const char *code_vary_refusal(const code_choice *choice, const fb_body *body, double hub_mass)
{
  if (choice->vary & CODE_HUB && body->effects & FB_EFFECT_LARGE_DEFLECTION) {
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

static const char code_body_status[] =
    "typedef enum @_status { /* values of fb_status */\n"
    "  @_ok = 0,\n  @_null = -1,        /* a pointer is NULL */\n"
    "  @_value = -2,       /* dt is not above 0 */\n"
    "  @_not_finite = -3,  /* not finite, or so large that its square is not */\n"
    "  @_singular = -5,    /* inertia that is not above zero */\n"
    "  @_step_length = -9, /* dt is longer than the stability limit, or the frame turns too far in a step */\n"
    "  @_range = -10       /* the deflection has left the range of the model */\n"
    "} @_status;\n\n";

static const char code_body_state[] =
    "/* All that changes; as fb_state. Kahan terms lost_.. are zero when a state is written. */\n"
    "typedef struct @_state {\n"
    "  $ rho[3];  /* [m] position of O, inertial axes */\n"
    "  $ quat[4]; /* attitude of the body frame, w x y z */\n"
    "  $ u[3];    /* [m/s] velocity, inertial axes: of the mass center; prescribed base: of O; pinned: zero */\n"
    "  $ L[3];    /* [N m s] angular momentum, inertial axes: about the mass center; pinned: about O; prescribed: zero "
    "*/\n";

static const char *const code_body_acts[3] = {
    "  $ force[3], torque[3]; /* [N], [N m] at O, body axes */\n",
    "  $ torque[3]; /* [N m] on the body, body axes */\n",
    "  $ v[3], w[3], v_dot[3]; /* [m/s], [rad/s], [m/s^2] of the base, body axes; v_dot for the limit */\n"};

static const char code_body_step[] =
    "/* At the inertial origin, at rest, undeformed. */\n"
    "void @_start(@_state *state);\n"
    "/* One step of classical Runge-Kutta, dt [s], under what acts at its start, middle and end. Refused: the state "
    "stays as\n"
    "   it was. */\n"
    "@_status @_step(%M@_state *state, const @_input *start, const @_input *middle, const @_input *end, $ dt);\n\n"
    "typedef struct @_motion {\n"
    "  $ v[3], w[3]; /* [m/s], [rad/s] of O, body axes */\n";

static const char code_body_reads[] =
    "/* Time derivatives of rho, quat, u, L, q, pi; rho_dot is the velocity of O. */\n"
    "@_status @_rates_eval(%M@_state *rate, const @_state *state, const @_input *in);\n"
    "@_status @_motion_eval(%M@_motion *motion, const @_state *state, const @_input *in);\n"
    "/* Node 0 is O, the others are those of the description in its order. @_value: no such node. */\n"
    "@_status @_node_eval(%M@_node *out, const @_state *state, const @_motion *motion, int node);\n";

/* State and what acts. */
static void code_write_body_types(const code *w)
{
  const int n = code_body.body->n > 0 ? code_body.body->n : 1, rotors = code_body.body->n_rotor;
  code_template(w, code_body_state);
  code_member(w, 2, "q", n, "coordinates of the modes..");
  code_member(w, 2, "pi", n, "..and their conjugate momenta");
  code_template(w, "  $ lost_rho[3], lost_u[3];\n");
  if (w->single) {
    code_template(w, "  $ lost_quat[4], lost_L[3], lost_h[3];\n");
    code_member(w, 2, "lost_q", n, NULL);
    code_member(w, 2, "lost_pi", n, NULL);
  }
  code_member(w, 2, "rotor_angle", rotors, "[rad] relative to the node");
  code_member(w, 2, "rotor_momentum", rotors, "[N m s]; L and pi contain the momenta");
  code_member(w, 2, "lost_rotor_angle", w->single ? rotors : 0, NULL);
  code_member(w, 2, "lost_rotor_momentum", w->single ? rotors : 0, NULL);
  code_template(w, "} @_state;\n\n"
                   "typedef struct @_input { /* what acts at one instant; all zero, or NULL: nothing */\n");
  code_template(w, code_body_acts[fbi_first_free(code_body.body->base) / 3]);
  code_member(w, 2, "rotor_motor", rotors,
              "[N m] on each rotor, and reversed on the body; where given: its momentum [N m s]");
  for (int k = 0; k < FB_MAX_NODES; k++) {
    if (node_is_in(&code_body.choice->loads, k)) {
      fprintf(w->out, "  %s force_%d[3], torque_%d[3]; /* [N], [N m] at node %d, body axes */\n", code_real(w), k, k,
              k);
    }
  }
  code_template(w, "} @_input;\n\n");
}

/* And, where parameters vary, the model; lanes of it are not aligned as vectors are. */
static void code_write_all_types(const code *w)
{
  const char *const loose = w->lanes == CODE_WIDE ? "_loose" : "";
  code_write_body_types(w);
  if (w->vary) {
    code_template(w, "typedef struct @_model { /* what parameters make of the description */\n");
    fprintf(w->out, "  %s%s mass; /* their factor of the mass */\n", code_real(w), loose);
    fprintf(w->out, "  %s%s k[%d]; /* its numbers that they change */\n", code_real(w), loose, w->places);
    code_template(w, "} @_model;\n\n");
  }
}

/* The parameters, and what makes a model of them. */
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
  code_template(
      w,
      "} @_parameters;\n\n"
      "/* NULL: as described. @_value: a factor is not 1e-6 to 1e6 (damping: 0 to 1e6), or less of the hub than there "
      "can\n   be. */\n"
      "@_status @_model_init(@_model *model, const @_parameters *parameters);\n");
}

/* The model of parameters; a trace writes what makes its numbers of factors. */
static void code_write_model_init(const code *w)
{
  code_template(
      w, "\nstatic @_status @_numbers(@_model *model, $ stiffness, $ damping, $ mass, $ hub_mass, $ hub_inertia);\n"
         "\n@_status @_model_init(@_model *model, const @_parameters *parameters)\n{\n"
         "  $ stiffness = `1`, damping = `1`, mass = `1`, hub_mass = `1`, hub_inertia = `1`;\n"
         "  if (!model) {\n    return @_null;\n  }\n"
         "  if (parameters) {\n");
  for (int k = 0; k < CODE_PARAMETERS; k++) {
    if (w->vary & 1 << k) {
      fprintf(w->out, "    %s = parameters->%s;\n", code_parameters[k].name, code_parameters[k].name);
    }
  }
  fputs("  }\n", w->out);
  for (int k = 0; k < CODE_PARAMETERS; k++) {
    if (w->vary & 1 << k) {
      fprintf(w->out, "  if (!(%s >= ", code_parameters[k].name);
      code_template(w, 1 << k == CODE_DAMPING ? "`0` && " : "`1e-6` && ");
      fputs(code_parameters[k].name, w->out);
      code_template(w, " <= `1e6`)) {\n    return @_value;\n  }\n");
    }
  }
  code_template(
      w,
      "  if (@_numbers(model, stiffness, damping, mass, hub_mass, hub_inertia) != @_ok) {\n    return @_value;\n  }\n"
      "  model->mass = mass;\n  return @_ok;\n}\n");
}

/* The comment at the head. */
static void code_write_body_comment(const code *w, const char *source, unsigned crc, void (*coordinate)(FILE *, int))
{
  static const char *const bases[FB_BASE_COUNT] = {"free", "prescribed", "pinned", "hinged"};
  const fb_body *const body = code_body.body;
  fprintf(w->out, "/* %s - made by reduce --code from ", w->name);
  output_source(w->out, source);
  fprintf(w->out,
          " with flexbeam %s, %s precision, model 0x%08X: a body\n"
          "   of %d modes on a %s base and its step of rk4: fb_rk4_step, traced (E8.9: tests/reference/THEORY.md). "
          "Include it where\n"
          "   needed; one file defines %s_IMPLEMENTATION before. SI units, radians.\n   Mass %.6g kg.",
          FB_VERSION, w->single ? "single" : "double", crc, body->n, bases[(int)body->base], w->name,
          (double)body->mass);
  for (int a = 0; a < body->n; a++) {
    fprintf(w->out, "\n   q[%d]: ", a);
    coordinate(w->out, a);
  }
  for (int r = 0; r < body->n_rotor; r++) {
    const fb_rotor *const rotor = &body->rotor[r];
    fprintf(w->out, "\n   rotor %d: about %.6g %.6g %.6g, %.6g kg m^2%s", r, (double)rotor->axis[0],
            (double)rotor->axis[1], (double)rotor->axis[2], (double)rotor->inertia,
            rotor->given ? ", its momentum given" : "");
  }
  fprintf(w->out, " */\n#ifndef %s_CODE\n#define %s_CODE\n#define %s_crc 0x%08Xu\n", w->name, w->name, w->name, crc);
  fputs("#ifdef __cplusplus\nextern \"C\" {\n#endif\n", w->out);
}

/* The declarations of the step of a body, and where its functions begin; coordinate: prints what one is. */
static code code_write_body(FILE *out, const fb_body *body, const code_choice *choice, const char *source,
                            void (*coordinate)(FILE *, int))
{
  const code own = {out, choice->name, choice->single, CODE_ONE, 0, choice->vary, choice->places}, *const w = &own;
  code_body.body = body;
  code_body.choice = choice;
  code_write_body_comment(w, source, fbi_body_crc(body, choice->single), coordinate);
  code_template(w, code_body_status);
  code_write_all_types(w);
  if (w->vary) {
    code_write_parameters(w);
  }
  code_template(w, code_body_step);
  code_member(w, 2, "q_dot", body->n > 0 ? body->n : 1, NULL);
  code_member(w, 2, "rotor_speed", body->n_rotor, "[rad/s] relative to the node");
  code_template(w, "} @_motion;\n\n");
  code_template(w, code_node_type);
  code_template(w, code_body_reads);
  if (body->base != FB_BASE_PRESCRIBED) {
    code_template(w, "\n");
    code_template(w, code_energy_type);
    code_template(w, "@_status @_energy_eval(%M@_energy *energy, const @_state *state);\n");
  }
  if (choice->lanes) {
    code_write_lanes(w, code_write_all_types);
  }
  code_template(w, "#ifdef __cplusplus\n}\n#endif\n#endif\n\n"
                   "#ifdef @_IMPLEMENTATION\n#include <math.h>\n#include <string.h>\n\n"
                   "\nvoid @_start(@_state *state)\n{\n"
                   "  memset(state, 0, sizeof *state);\n"
                   "  state->quat[0] = `1`;\n}\n");
  if (w->vary) {
    code_write_model_init(w);
  }
  return own;
}
#endif
