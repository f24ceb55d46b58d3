/* linear_out.h - writes a linear model, d/dt x = A x + B u, y = C x + D u, with names and units of x, u and y, the steady
   state that it is about, and the check word of the model: CSV, or JSON where the name of the file says so.
   tools/linear.py makes .mat and .npz of JSON. Include after flexbeam.h:

     static linear_out out;
     linear_out_body(&out, "boom", &linear, &ports, &body, &state, &motion); // of fb_body_linearize, fb_body_motion_eval
     failed = linear_out_write(&out, "boom.json");                           // 0, or errno tells why

   x, u and y are deviations from the steady state. Names may be replaced before the file is written. */
#ifndef LINEAR_OUT_H
#define LINEAR_OUT_H
#include "output.h"
#include "../tools/inside.h"
#include <math.h>

#ifndef LINEAR_OUT_PORTS
#define LINEAR_OUT_PORTS FB_MAX_PORTS
#endif
#if FB_WITH_EXACT
#define LINEAR_OUT_STATES (FB_MAX_LINEAR > FB_EXACT_STATES ? FB_MAX_LINEAR : FB_EXACT_STATES)
#else
#define LINEAR_OUT_STATES FB_MAX_LINEAR
#endif
#define LINEAR_OUT_POINT (FB_MAX_BODIES * (13 + 2 * FBI_MAX_COORDINATES))

typedef struct linear_value {
  char name[80], unit[32];
  double value; /* of a state, input or output: not used */
} linear_value;

typedef struct linear_names { /* of a system, by body and by the joint that carries it; NULL: body0, joint0, .. */
  const char *body[FB_MAX_BODIES], *joint[FB_MAX_BODIES];
} linear_names;

typedef struct linear_out {
  const char *source; /* what it is of: a file, a name */
  unsigned crc;       /* fb_body_crc, fb_system_crc, fb_exact_crc */
  int n, n_in, n_out, n_point;
  const fb_real *A, *B, *C, *D;
  double error; /* fb_linear.error; of an exact beam 0: nobody estimates it */
  linear_value state[LINEAR_OUT_STATES], in[LINEAR_OUT_PORTS], out[LINEAR_OUT_PORTS], point[LINEAR_OUT_POINT];
} linear_out;

/* ---- names */

static const char linear_axes[] = "xyz";
typedef struct linear_port {
  const char *name, *unit;
} linear_port;

static const linear_port linear_ports[] = {{"force", "N"},
                                           {"torque", "N m"},
                                           {"base_velocity", "m/s"},
                                           {"base_rate", "rad/s"},
                                           {"displacement", "m"},
                                           {"rotation", "rad"},
                                           {"rate", "rad/s"},
                                           {"acceleration", "m/s^2"},
                                           {"drive", "N m"},
                                           {"coordinate", "rad"},
                                           {"speed", "rad/s"},
                                           {"pull", "N"},
                                           {"length", "m"},
                                           {"motor", "N m"},
                                           {"rotor_speed", "rad/s"},
                                           {"velocity", "m/s"},
                                           {"internal_force", "N"},
                                           {"internal_moment", "N m"},
                                           {"force_strain", "-"},
                                           {"moment_strain", "1/m"},
                                           {"support_displacement", "m"},
                                           {"support_rotation", "rad"}};
typedef char linear_ports_are_whole[sizeof linear_ports / sizeof linear_ports[0] == FB_PORT_COUNT ? 1 : -1];

static inline void linear_name(linear_value *v, const char *unit, const char *before, const char *of, const char *what)
{
  snprintf(v->name, sizeof v->name, "%.8s%.32s%s%.32s", before, of, of[0] && what[0] ? "." : "", what);
  snprintf(v->unit, sizeof v->unit, "%s", unit);
}

static inline void linear_add_point(linear_out *out, const char *unit, const char *of, const char *what, fb_real value)
{
  linear_value *const v = &out->point[out->n_point];
  if (out->n_point < LINEAR_OUT_POINT) {
    linear_name(v, unit, "", of, what);
    v->value = (double)value;
    out->n_point++;
  }
}

/* n components of a vector, x to z or w to z */
static inline void linear_add_vector(linear_out *out, const char *unit, const char *of, const char *what,
                                     const fb_real *value, int n)
{
  char name[32];
  for (int i = 0; i < n; i++) {
    snprintf(name, sizeof name, "%.20s_%c", what, n == 4 ? "wxyz"[i] : linear_axes[i]);
    linear_add_point(out, unit, of, name, value[i]);
  }
}

/* Elastic coordinates: their unit is that of modes of unit modal mass, else of displacements. */
static inline void linear_add_modes(linear_out *out, const char *of, const fb_body *body, const fb_real *q,
                                    const fb_real *q_dot)
{
  char name[32];
  for (int a = 0; a < 2 * body->n; a++) {
    const int rate = a >= body->n, k = rate ? a - body->n : a;
    snprintf(name, sizeof name, rate ? "q%d_rate" : "q%d", k + 1);
    linear_add_point(out, body->unit_mass ? (rate ? "sqrt(kg) m/s" : "sqrt(kg) m") : (rate ? "m/s" : "m"), of, name,
                     (rate ? q_dot : q)[k]);
  }
}

static inline void linear_name_mode(linear_value *q, linear_value *p, const char *of, const fb_body *body, int a)
{
  char name[32];
  snprintf(name, sizeof name, "q%d", a + 1);
  linear_name(q, body->unit_mass ? "sqrt(kg) m" : "m", "", of, name);
  linear_name(p, body->unit_mass ? "sqrt(kg) m/s" : "kg m/s", "p_", of, name);
}

/* Component i of position and attitude, and the momentum along it. */
static inline void linear_name_pose(linear_value *x, linear_value *p, const char *of, int i)
{
  char name[32];
  snprintf(name, sizeof name, "%s_%c", i < 3 ? "position" : "attitude", linear_axes[i % 3]);
  linear_name(x, i < 3 ? "m" : "rad", "", of, name);
  linear_name(p, i < 3 ? "N s" : "N m s", "p_", of, name);
}

/* Does axis i of a joint slide? */
static inline int linear_axis_slides(fb_joint_kind kind, int i)
{
  return kind == FB_JOINT_PRISMATIC || (kind == FB_JOINT_CYLINDRICAL && i == 1);
}

/* A port by its kind and numbers, as force.NODE.AXIS, of systems force.BODY.NODE.AXIS, of exact beams drive.JOINT. */
static inline void linear_name_port(linear_value *v, const fb_port *port, const fb_system *system)
{
  static const char *const sliding[] = {"N", "m", "m/s"};
  const fb_port_kind kind = port->kind;
  const int of_joint = kind >= FB_PORT_DRIVE && kind <= FB_PORT_SPEED;
  const int slides = of_joint && system && linear_axis_slides(system->joint[port->body].kind, port->axis);
  char place[64] = "", body[16] = "";
  if (kind < FB_PORT_DRIVE || kind > FB_PORT_ROTOR_SPEED) {
    char node[16] = "";
    if (kind != FB_PORT_BASE_VELOCITY && kind != FB_PORT_BASE_RATE) {
      snprintf(node, sizeof node, "%d.", port->node);
    }
    if (system) {
      snprintf(body, sizeof body, "%d.", port->body);
    }
    snprintf(place, sizeof place, "%s%s%c", body, node, linear_axes[port->axis]);
  } else if (system && kind >= FB_PORT_MOTOR) {
    snprintf(place, sizeof place, "%d.%d", port->body, port->axis);
  } else if (system && of_joint) {
    snprintf(place, sizeof place, "%d.%d", port->body, port->axis + 1);
  } else {
    snprintf(place, sizeof place, "%d", kind < FB_PORT_MOTOR ? port->body : port->axis);
  }
  linear_name(v, slides ? sliding[kind - FB_PORT_DRIVE] : linear_ports[kind].unit, "", linear_ports[kind].name, place);
}

static inline void linear_name_ports(linear_out *out, const fb_linear_desc *desc, const fb_system *system)
{
  for (int k = 0; k < out->n_in; k++) {
    linear_name_port(&out->in[k], &desc->in[k], system);
  }
  for (int k = 0; k < out->n_out; k++) {
    linear_name_port(&out->out[k], &desc->out[k], system);
  }
}

/* ---- what a linear model is about */

static inline void linear_out_begin(linear_out *out, const char *source, unsigned crc, const fb_linear *linear)
{
  memset(out, 0, sizeof *out);
  out->source = source;
  out->crc = crc;
  out->n = linear->n;
  out->n_in = linear->n_in;
  out->n_out = linear->n_out;
  out->A = linear->A;
  out->B = linear->B;
  out->C = linear->C;
  out->D = linear->D;
  out->error = (double)linear->error;
}

/* Of fb_body_linearize; desc NULL: no ports. motion: of fb_body_motion_eval at the steady state. linear stays there
   until the file is written. */
static inline void linear_out_body(linear_out *out, const char *source, const fb_linear *linear,
                                   const fb_linear_desc *desc, const fb_body *body, const fb_state *state,
                                   const fb_motion *motion)
{
  const int n_free = linear->n_free;
  linear_value *const x = out->state, *momentum = x + 2 * body->n;
  linear_out_begin(out, source, fb_body_crc(body), linear);

  /* x = (q, pi, momenta of rotors, momenta, pose) */
  for (int a = 0; a < body->n; a++) {
    linear_name_mode(&x[a], &x[body->n + a], "", body, a);
  }
#if FB_WITH_ROTORS
  for (int k = 0; k < body->n_rotor && momentum < x + 2 * body->n + linear->n_rotor; k++) {
    if (!body->rotor[k].given) {
      char name[32];
      snprintf(name, sizeof name, "rotor%d", k);
      linear_name(momentum++, "N m s", "p_", "", name);
    }
  }
#endif
  for (int i = 0; i < n_free; i++) { /* a pinned base has the last three, a hinged one the last */
    linear_name_pose(&x[linear->n - n_free + i], &x[linear->n - 2 * n_free + i], "", 6 - n_free + i);
  }
  linear_name_ports(out, desc, NULL);

  /* steady state */
  linear_add_vector(out, "m", "", "position", state->rho, 3);
  linear_add_vector(out, "-", "", "attitude", state->quat, 4);
  linear_add_vector(out, "m/s", "", "velocity", motion->v, 3);
  linear_add_vector(out, "rad/s", "", "spin", motion->w, 3);
  linear_add_modes(out, "", body, state->q, motion->q_dot);
#if FB_WITH_ROTORS
  for (int k = 0; k < body->n_rotor; k++) {
    char name[32];
    snprintf(name, sizeof name, "rotor%d_speed", k);
    linear_add_point(out, "rad/s", "", name, motion->rotor_speed[k]);
  }
#endif
}

static inline const char *linear_of(char text[48], const char *name, const char *kind, int k)
{
  if (name) {
    snprintf(text, 48, "%.32s", name);
  } else {
    snprintf(text, 48, "%s%d", kind, k);
  }
  return text;
}

/* Free axes of the joint that carries body b: their number, which they are. */
static inline int linear_free_axes(int axis[6], const fb_system *system, const fb_system_state *state, int b)
{
  const int n_axis = system->joint[b].n_axis, whole = n_axis > 2;
  int n = 0;
  for (int i = 0; i < n_axis; i++) {
    axis[n] = i;
    n += state->mode[b][whole ? 0 : i] == FB_AXIS_FREE;
  }
  return n;
}

/* Name of axis i of a joint, and of the momentum along it. */
static inline void linear_name_axis(linear_value *x, linear_value *p, const char *of, fb_joint_kind kind, int i)
{
  char name[32];
  if (kind == FB_JOINT_FREE || kind == FB_JOINT_SPHERICAL) {
    linear_name_pose(x, p, of, kind == FB_JOINT_FREE ? i : 3 + i);
    return;
  }
  snprintf(name, sizeof name, "%d", i + 1);
  linear_name(x, linear_axis_slides(kind, i) ? "m" : "rad", "", of, name);
  linear_name(p, linear_axis_slides(kind, i) ? "N s" : "N m s", "p_", of, name);
}

/* x = (free axes of all joints, q of all bodies, momenta, those of rotors): with loops those of the list alone */
static inline void linear_name_system(linear_out *out, const fb_linear *linear, const fb_system *system,
                                      const fb_body *body, const fb_system_state *state, const linear_names *names)
{
  static linear_value x[FB_MAX_LINEAR + 6 * FB_MAX_BODIES], p[FB_MAX_LINEAR + 6 * FB_MAX_BODIES];
  char of[48];
  const int half = (linear->n - linear->n_rotor) / 2;
  int n = 0, axis[6];
  for (int b = 0; b < system->n_body; b++) {
    const int free = linear_free_axes(axis, system, state, b);
    for (int i = 0; i < free; i++, n++) {
      linear_name_axis(&x[n], &p[n], linear_of(of, names ? names->joint[b] : NULL, "joint", b), system->joint[b].kind,
                       axis[i]);
    }
  }
  for (int b = 0; b < system->n_body; b++) {
    const fb_body *const of_body = &body[system->model[b]];
    for (int a = 0; a < of_body->n; a++, n++) {
      linear_name_mode(&x[n], &p[n], linear_of(of, names ? names->body[b] : NULL, "body", b), of_body, a);
    }
  }
  for (int i = 0; i < half; i++) {
    out->state[i] = x[linear->coordinate[i]];
    out->state[half + i] = p[linear->coordinate[i]];
  }
#if FB_WITH_ROTORS
  n = 2 * half;
  for (int b = 0; b < system->n_body; b++) {
    const fb_body *const of_body = &body[system->model[b]];
    for (int k = 0; k < of_body->n_rotor && n < linear->n; k++) {
      if (!of_body->rotor[k].given) {
        char name[32];
        snprintf(name, sizeof name, "rotor%d", k);
        linear_name(&out->state[n++], "N m s", "p_", linear_of(of, names ? names->body[b] : NULL, "body", b), name);
      }
    }
  }
#endif
}

/* Of fb_system_linearize; desc, names NULL: none. motion: of fb_system_motion_eval at the steady state. */
static inline void linear_out_system(linear_out *out, const char *source, const fb_linear *linear,
                                     const fb_linear_desc *desc, const fb_system *system, const fb_body *body,
                                     int n_model, const fb_system_state *state, const fb_system_motion *motion,
                                     const linear_names *names)
{
  char of[48], name[32];
  linear_out_begin(out, source, fb_system_crc(system, body, n_model), linear);
  linear_name_system(out, linear, system, body, state, names);
  linear_name_ports(out, desc, system);

  /* steady state */
  for (int b = 0; b < system->n_body; b++) {
    const fb_state *const pose = &motion->pose[b];
    const fb_joint *const joint = &system->joint[b];
    (void)linear_of(of, names ? names->body[b] : NULL, "body", b);
    linear_add_vector(out, "m", of, "position", pose->rho, 3);
    linear_add_vector(out, "-", of, "attitude", pose->quat, 4);
    linear_add_vector(out, "m/s", of, "velocity", motion->motion[b].v, 3);
    linear_add_vector(out, "rad/s", of, "spin", motion->motion[b].w, 3);
    linear_add_modes(out, of, &body[system->model[b]], pose->q, motion->motion[b].q_dot);
#if FB_WITH_ROTORS
    for (int k = 0; k < body[system->model[b]].n_rotor; k++) {
      snprintf(name, sizeof name, "rotor%d_speed", k);
      linear_add_point(out, "rad/s", of, name, motion->motion[b].rotor_speed[k]);
    }
#endif
    (void)linear_of(of, names ? names->joint[b] : NULL, "joint", b);
    for (int i = 0; i < joint->n_axis && joint->n_axis < 3; i++) {
      const int slides = linear_axis_slides(joint->kind, i);
      snprintf(name, sizeof name, "%d", i + 1);
      linear_add_point(out, slides ? "m" : "rad", of, name, motion->joint[b].value[i]);
      snprintf(name, sizeof name, "%d_speed", i + 1);
      linear_add_point(out, slides ? "m/s" : "rad/s", of, name, motion->joint[b].speed[i]);
    }
  }
}

#if FB_WITH_EXACT
/* Of fb_exact_linearize; desc NULL: no ports. node: of fb_exact_nodes_eval at the steady state under `input`; its last
   one is the tip. States are the modes' own, two of one that oscillates. */
static inline void linear_out_exact(linear_out *out, const char *source, const fb_exact_linear *linear,
                                    const fb_linear_desc *desc, const fb_exact *exact, const fb_exact_node *node,
                                    const fb_exact_input *input)
{
  int n = 0;
  memset(out, 0, sizeof *out);
  out->source = source;
  out->crc = fb_exact_crc(exact);
  out->n = linear->n;
  out->n_in = linear->n_in;
  out->n_out = linear->n_out;
  out->A = linear->A;
  out->B = linear->B;
  out->C = linear->C;
  out->D = linear->D;
  for (int k = 0; k < linear->n_mode; k++) {
    const int pair = FB_FABS(linear->im[k]) > FB_R(0.0);
    for (int part = 0; part <= pair; part++) {
      char name[32];
      snprintf(name, sizeof name, "mode%d%s", k + 1, !pair ? "" : part ? "_b" : "_a");
      linear_name(&out->state[n++], "-", "", "", name);
    }
  }
  linear_name_ports(out, desc, NULL);
  linear_add_vector(out, "m/s", "base", "velocity", input->v, 3);
  linear_add_vector(out, "rad/s", "base", "spin", input->w, 3);
  for (int end = 0; end < 2; end++) {
    const fb_exact_node *const at = &node[end ? exact->n : 0];
    linear_add_vector(out, "m", end ? "tip" : "root", "position", at->position, 3);
    linear_add_vector(out, "-", end ? "tip" : "root", "attitude", at->quat, 4);
  }
}
#endif

/* ---- files */

/* Numbers as they are, to the last bit. */
static inline void linear_put(FILE *file, double x)
{
  fprintf(file, FB_SINGLE ? "%.9g" : "%.17g", x);
}

/* Text between quotes: "" in CSV, \" in JSON. */
static inline void linear_quote(FILE *file, const char *text, int json)
{
  fputc('"', file);
  for (; *text; text++) {
    if (*text == '"' || (json && *text == '\\')) {
      fputc(json ? '\\' : '"', file);
    }
    fputc((unsigned char)*text < ' ' ? ' ' : *text, file);
  }
  fputc('"', file);
}

static inline void linear_json_list(FILE *file, const char *key, const linear_value *list, int n, int valued)
{
  fprintf(file, "  \"%s\": [", key);
  for (int k = 0; k < n; k++) {
    fputs(k > 0 ? ",\n    {\"name\": " : "\n    {\"name\": ", file);
    linear_quote(file, list[k].name, 1);
    fputs(", \"unit\": ", file);
    linear_quote(file, list[k].unit, 1);
    if (valued) {
      fputs(", \"value\": ", file);
      linear_put(file, list[k].value);
    }
    fputc('}', file);
  }
  fputs("],\n", file);
}

static inline void linear_json_matrix(FILE *file, const char *key, const fb_real *M, int rows, int columns)
{
  fprintf(file, "  \"%s\": [", key);
  for (int i = 0; i < rows; i++) {
    fputs(i > 0 ? ",\n    [" : "\n    [", file);
    for (int j = 0; j < columns; j++) {
      fputs(j > 0 ? ", " : "", file);
      linear_put(file, (double)M[columns * i + j]);
    }
    fputc(']', file);
  }
  fputs(key[0] == 'D' ? "]\n" : "],\n", file);
}

static inline void linear_put_json(FILE *file, const linear_out *out)
{
  fprintf(file, "{\n  \"format\": \"flexbeam linear model 1\",\n  \"flexbeam\": \"%s\",\n  \"precision\": \"%s\",\n",
          FB_VERSION, FB_SINGLE ? "single" : "double");
  fputs("  \"model\": ", file);
  linear_quote(file, out->source, 1);
  fprintf(file, ",\n  \"crc\": \"%08X\",\n  \"error\": ", out->crc);
  linear_put(file, out->error);
  fputs(",\n", file);
  linear_json_list(file, "steady_state", out->point, out->n_point, 1);
  linear_json_list(file, "states", out->state, out->n, 0);
  linear_json_list(file, "inputs", out->in, out->n_in, 0);
  linear_json_list(file, "outputs", out->out, out->n_out, 0);
  linear_json_matrix(file, "A", out->A, out->n, out->n);
  linear_json_matrix(file, "B", out->B, out->n, out->n_in);
  linear_json_matrix(file, "C", out->C, out->n_out, out->n);
  linear_json_matrix(file, "D", out->D, out->n_out, out->n_in);
  fputs("}\n", file);
}

/* Entries of a CSV line that begins with a comma: names, or units. */
static inline void linear_csv_head(FILE *file, const linear_value *list, int n, int unit)
{
  for (int k = 0; k < n; k++) {
    fputc(',', file);
    linear_quote(file, unit ? list[k].unit : list[k].name, 0);
  }
}

/* A line of [A B] or [C D]. */
static inline void linear_csv_row(FILE *file, const linear_value *of, const char *rate, const fb_real *x,
                                  const fb_real *u, const linear_out *out)
{
  char text[96];
  snprintf(text, sizeof text, rate[0] ? "d/dt %s" : "%s", of->name);
  linear_quote(file, text, 0);
  fputc(',', file);
  snprintf(text, sizeof text, "%s%s", of->unit, rate);
  linear_quote(file, text, 0);
  for (int j = 0; j < out->n + out->n_in; j++) {
    fputc(',', file);
    linear_put(file, (double)(j < out->n ? x[j] : u[j - out->n]));
  }
  fputc('\n', file);
}

/* The matrix [A B; C D]: a line of names, one of units, then a line for each rate and output. */
static inline void linear_put_csv(FILE *file, const linear_out *out)
{
  fprintf(
      file,
      "# flexbeam linear model 1: d/dt x = A x + B u, y = C x + D u as [A B; C D], %d states, %d inputs, %d outputs\n",
      out->n, out->n_in, out->n_out);
  fprintf(file, "# model %s, crc %08X, flexbeam %s, %s precision, error ", out->source, out->crc, FB_VERSION,
          FB_SINGLE ? "single" : "double");
  linear_put(file, out->error);
  fputs("\n# about the steady state\n", file);
  for (int k = 0; k < out->n_point; k++) {
    fprintf(file, "# %s [%s] = ", out->point[k].name, out->point[k].unit);
    linear_put(file, out->point[k].value);
    fputc('\n', file);
  }
  for (int unit = 0; unit < 2; unit++) {
    fputs(unit ? "\"\",\"unit\"" : "\"name\",\"unit\"", file);
    linear_csv_head(file, out->state, out->n, unit);
    linear_csv_head(file, out->in, out->n_in, unit);
    fputc('\n', file);
  }
  for (int i = 0; i < out->n; i++) {
    linear_csv_row(file, &out->state[i], "/s", out->A + out->n * i, out->B + out->n_in * i, out);
  }
  for (int i = 0; i < out->n_out; i++) {
    linear_csv_row(file, &out->out[i], "", out->C + out->n * i, out->D + out->n_in * i, out);
  }
}

/* 0; 1 where not all of it is written, errno tells why. */
static inline int linear_out_write(const linear_out *out, const char *name)
{
  const size_t n = strlen(name);
  FILE *const file = output_open(name);
  if (!file) {
    return 1;
  }
  (n > 5 && strcmp(name + n - 5, ".json") == 0 ? linear_put_json : linear_put_csv)(file, out);
  return !output_is_whole(file, name);
}
#endif
