/* fmu_variables.h - the variables of an FMU, one table for the exporter, which writes it as XML, and for the FMU, which
   serves it. A variable is a number or a vector; value references count numbers: that of a vector is its first
   element's. Those of a scene have the names and units that the scene gives them (fmu_scene.h). Include flexbeam.h
   first. */
#ifndef FMU_VARIABLES_H
#define FMU_VARIABLES_H
#include <float.h>
#include <stdio.h>

typedef enum fmu_role { FMU_INDEPENDENT, FMU_INPUT, FMU_OUTPUT, FMU_PARAMETER } fmu_role;
typedef enum fmu_place {
  FMU_OF_BODY,
  FMU_OF_NODE,
  FMU_OF_TIP,
  FMU_OF_SCENE
} fmu_place;             /* tip: every node but the hub */
enum { FMU_MODES = -1 }; /* as many numbers as there are modes */

/* On which inputs an output depends directly: forces and gravity move accelerations, the motion of a base velocities,
   too; 1 of a scene: on all */
typedef enum fmu_source { FMU_BY_NONE, FMU_BY_ALL, FMU_BY_GRAVITY, FMU_BY_BASE } fmu_source;

/* kind, role, place, numbers, name (of nodes behind "hub." or the node's name), unit, the inputs on which it depends
   directly, meaning */
#define FMU_KINDS(X)                                                                                                  \
  X(TIME, INDEPENDENT, BODY, 1, "time", "s", 0, "time")                                                               \
  X(GRAVITY, INPUT, BODY, 3, "gravity", "m/s2", 0, "uniform gravity, inertial axes")                                  \
  X(FORCE, INPUT, NODE, 3, "force", "N", 0, "force that acts there, body axes")                                       \
  X(TORQUE, INPUT, NODE, 3, "torque", "N.m", 0, "torque that acts there, body axes")                                  \
  X(BASE_VELOCITY, INPUT, BODY, 3, "base.velocity", "m/s", 0, "of the hub, body axes; base.acceleration goes on")     \
  X(BASE_RATE, INPUT, BODY, 3, "base.rate", "rad/s", 0, "of the hub, body axes; base.angular_acceleration goes on")   \
  X(BASE_ACCELERATION, INPUT, BODY, 3, "base.acceleration", "m/s2", 0, "rate of base.velocity, body axes")            \
  X(BASE_RATE_DOT, INPUT, BODY, 3, "base.angular_acceleration", "rad/s2", 0, "rate of base.rate, body axes")          \
  X(POSITION, OUTPUT, NODE, 3, "position", "m", 0, "position, inertial axes")                                         \
  X(ATTITUDE, OUTPUT, NODE, 4, "attitude", NULL, 0, "unit quaternion w x y z, axes of the section to inertial ones")  \
  X(VELOCITY, OUTPUT, NODE, 3, "velocity", "m/s", 3, "velocity, inertial axes")                                       \
  X(RATE, OUTPUT, NODE, 3, "rate", "rad/s", 3, "angular velocity, axes of the section: a gyro there")                 \
  X(ACCELERATION, OUTPUT, NODE, 3, "acceleration", "m/s2", 1, "acceleration, inertial axes")                          \
  X(RATE_DOT, OUTPUT, NODE, 3, "angular_acceleration", "rad/s2", 1, "angular acceleration, axes of the section")      \
  X(DEFLECTION, OUTPUT, TIP, 3, "deflection", "m", 0, "elastic displacement, body axes")                              \
  X(ROTATION, OUTPUT, TIP, 3, "rotation", "rad", 0, "elastic rotation vector, body axes")                             \
  X(REACTION_FORCE, OUTPUT, BODY, 3, "hub.reaction_force", "N", 1, "of the support on the hub, body axes")            \
  X(REACTION_TORQUE, OUTPUT, BODY, 3, "hub.reaction_torque", "N.m", 1, "of the support on the hub, body axes")        \
  X(Q, OUTPUT, BODY, FMU_MODES, "modes.q", NULL, 0, "modal coordinates")                                              \
  X(Q_DOT, OUTPUT, BODY, FMU_MODES, "modes.q_dot", NULL, 3, "their rates")                                            \
  X(KINETIC, OUTPUT, BODY, 1, "energy.kinetic", "J", 3, "kinetic energy")                                             \
  X(STRAIN, OUTPUT, BODY, 1, "energy.strain", "J", 0, "strain energy")                                                \
  X(POTENTIAL, OUTPUT, BODY, 1, "energy.gravity", "J", 2, "energy in gravity")                                        \
  X(STEP, PARAMETER, BODY, 1, "settings.step", "s", 0, "longest step of the integrator")                              \
  X(INTEGRATOR, PARAMETER, BODY, 1, "settings.integrator", NULL, 0, "rk4, midpoint, sdirk or exponential")            \
  X(DAMPING, PARAMETER, BODY, 1, "settings.damping_scale", NULL, 0, "factor of the damping of all modes")             \
  X(STIFFNESS, PARAMETER, BODY, 1, "settings.stiffness_scale", NULL, 0, "factor of all stiffness; ratios stay")       \
  X(MASS, PARAMETER, BODY, 1, "settings.mass_scale", NULL, 0, "factor of all masses but the hub's")                   \
  X(HUB_MASS, PARAMETER, BODY, 1, "settings.hub_mass_scale", NULL, 0, "factor of the hub's mass; its center stays")   \
  X(HUB_INERTIA, PARAMETER, BODY, 1, "settings.hub_inertia_scale", NULL, 0, "of the hub, about its mass center")      \
  X(EFFECTS, PARAMETER, BODY, 1, "settings.effects", NULL, 0, "as described, or fewer: linear, spin, full")           \
  X(START_POSITION, PARAMETER, BODY, 3, "start.position", "m", 0, "of the hub, inertial axes")                        \
  X(START_ATTITUDE, PARAMETER, BODY, 4, "start.attitude", NULL, 0, "of the hub, quaternion w x y z of any length")    \
  X(START_VELOCITY, PARAMETER, BODY, 3, "start.velocity", "m/s", 0, "of the hub, inertial axes")                      \
  X(START_RATE, PARAMETER, BODY, 3, "start.rate", "rad/s", 0, "of the hub, body axes")                                \
  X(START_Q, PARAMETER, BODY, FMU_MODES, "start.q", NULL, 0, "modal coordinates")                                     \
  X(START_Q_DOT, PARAMETER, BODY, FMU_MODES, "start.q_dot", NULL, 0, "their rates")                                   \
  X(SCENE_INPUT, INPUT, SCENE, 1, "", NULL, 0, "added to what the scene says")                                        \
  X(SCENE_OUTPUT, OUTPUT, SCENE, 1, "", NULL, 0, "")                                                                  \
  X(SCENE_STEP, PARAMETER, SCENE, 1, "", NULL, 0, "longest step of the integrator; 0: as the scene says")             \
  X(SCENE_EARLY, PARAMETER, SCENE, 1, "", NULL, 0, "1: a step ends at an event, with Discard and lastSuccessfulTime") \
  X(SCENE_PARAMETER, PARAMETER, SCENE, 1, "", NULL, 0, "parameter of the scene")

#define FMU_KIND_ENUM(kind, role, place, count, name, unit, direct, what) FMU_##kind,
typedef enum fmu_kind { FMU_KINDS(FMU_KIND_ENUM) FMU_KIND_COUNT } fmu_kind;
#undef FMU_KIND_ENUM

typedef struct fmu_row {
  fmu_role role;
  fmu_place place;
  int count;
  const char *name, *unit;
  int direct;
  const char *what;
} fmu_row;

#define FMU_KIND_ROW(kind, role, place, count, name, unit, direct, what) \
  {FMU_##role, FMU_OF_##place, count, name, unit, direct, what},
static const fmu_row fmu_rows[] = {FMU_KINDS(FMU_KIND_ROW)};
#undef FMU_KIND_ROW

typedef struct fmu_variable {
  fmu_kind kind;
  int node, first, count; /* first: value reference */
  /* of a scene: */
  const char *name, *unit, *what; /* unit, what NULL: none */
  double start;
  int direct;
} fmu_variable;

/* Why an FMU does not do what it is asked to: the status of FMI 2 and 3, and the reason. */
typedef enum fmu_answer { FMU_OK = 0, FMU_DISCARD = 2, FMU_ERROR = 3 } fmu_answer;
typedef char fmu_text[768];
#define FMU_NAME ((size_t)96)   /* characters of the name of a variable */
#define FMU_PATH ((size_t)1024) /* of a folder */

typedef struct fmu_span { /* a part of a state */
  void *at;
  size_t bytes;
} fmu_span;
#define FMU_MAX_SPANS 24

#define FMU_INSTANT 1e-4        /* [s] at most, between the outputs of which derivatives are made */
#define FMU_SAME 1e-9           /* relative difference of times that are the same */
#define FMU_MOST_STEPS 10000000 /* of a model within a communication step */

typedef struct fmu_values { /* numbers of variables */
  const fmu_variable *variable;
  int n;
  double *value;
} fmu_values;

/* Numbers of one kind, of node 0 where it has any; NULL: it is not there. */
static inline double *fmu_of(const fmu_values *v, fmu_kind kind, int node)
{
  for (int k = 0; k < v->n; k++) {
    if (v->variable[k].kind == kind && v->variable[k].node == node) {
      return v->value + v->variable[k].first;
    }
  }
  return NULL;
}

#define FMU_MAX_VARIABLES (FMU_KIND_COUNT * (FB_MAX_NODES + 1))
#define FMU_MAX_VALUES (64 + 34 * FB_MAX_NODES + 4 * FB_MAX_MODES) /* enough for the numbers of all of them */

/* Its name without the number of an element; node: that of its node. */
static inline void fmu_name(char name[FMU_NAME], const fmu_variable *v, const char *node)
{
  const fmu_row *const row = &fmu_rows[v->kind];
  const int at_node = row->place == FMU_OF_NODE || row->place == FMU_OF_TIP;
  snprintf(name, FMU_NAME - 16, "%s%s%s", at_node ? node : "", at_node ? "." : "", v->name ? v->name : row->name);
}

static inline const char *fmu_unit(const fmu_variable *v)
{
  return v->name ? v->unit : fmu_rows[v->kind].unit;
}

static inline const char *fmu_what(const fmu_variable *v)
{
  return v->what ? v->what : fmu_rows[v->kind].what;
}

/* Does an output depend on an input directly? */
static inline int fmu_follows(const fmu_variable *output, const fmu_variable *input)
{
  switch (output->name ? output->direct : fmu_rows[output->kind].direct) {
  case FMU_BY_ALL:
    return 1;
  case FMU_BY_GRAVITY:
    return input->kind == FMU_GRAVITY;
  case FMU_BY_BASE:
    return input->kind == FMU_BASE_VELOCITY || input->kind == FMU_BASE_RATE;
  default:
    return 0;
  }
}

/* Sets of effects by settings.effects: 1 as described, and these. */
#define FMU_EFFECTS_CHOICES 4
static const unsigned fmu_effects[FMU_EFFECTS_CHOICES] = {0, FB_EFFECTS_LINEAR, FB_EFFECTS_SPIN, FB_EFFECTS_FULL};

/* Is it an enumeration, which counts from 1? */
static inline int fmu_is_choice(fmu_kind kind)
{
  return kind == FMU_INTEGRATOR || kind == FMU_EFFECTS;
}

static inline int fmu_choices(fmu_kind kind)
{
  return kind == FMU_EFFECTS ? FMU_EFFECTS_CHOICES : (int)FB_INTEGRATOR_COUNT;
}

/* Factors of what is in the description; 1: as it is. */
#define FMU_FACTOR_LEAST 1e-6
#define FMU_FACTOR_MOST 1e6
static inline int fmu_is_factor(fmu_kind kind)
{
  return kind == FMU_STIFFNESS || kind == FMU_MASS || kind == FMU_HUB_MASS || kind == FMU_HUB_INERTIA;
}

/* What a body is built of anew where a parameter is not as described: all but the hub, and the hub. */
typedef struct fmu_parts {
  fb_shape rest;
  fb_body_desc desc;
  fb_real hub_mass, hub_center[3], hub_inertia[6];
} fmu_parts;

/* Does it leave a body those effects or fewer? */
static inline int fmu_has_effects(const fb_body *body, int choice)
{
  return (fmu_effects[choice - 1] & ~body->effects) == 0;
}

/* Does a body have it? Settings and states that a body does not have are left out. */
static inline int fmu_has(const fb_body *body, const fmu_parts *parts, fmu_kind kind)
{
  const int held = body->base != FB_BASE_FREE, moved = body->base == FB_BASE_PRESCRIBED;
  const int large = (body->effects & FB_EFFECT_LARGE_DEFLECTION) != 0;
  switch (kind) {
  case FMU_BASE_VELOCITY:
  case FMU_BASE_RATE:
  case FMU_BASE_ACCELERATION:
  case FMU_BASE_RATE_DOT:
    return moved;
  case FMU_START_RATE:
    return !moved;
  case FMU_STIFFNESS:
    return body->n > 0;
  case FMU_EFFECTS:
    return body->n > 0 && !large;
  case FMU_MASS:
    return !large && parts->rest.mass > FB_R(0.0);
  case FMU_HUB_MASS:
    return parts->hub_mass > FB_R(0.0);
  case FMU_HUB_INERTIA:
    return parts->hub_inertia[0] + parts->hub_inertia[1] + parts->hub_inertia[2] > FB_R(0.0);
  case FMU_GRAVITY:
    return (body->effects & FB_EFFECT_GRAVITY) != 0;
  case FMU_DAMPING:
    return (body->effects & FB_EFFECT_DAMPING) != 0;
  case FMU_REACTION_FORCE:
  case FMU_REACTION_TORQUE:
    return held;
  case FMU_START_VELOCITY:
    return !held;
  default:
    return fmu_rows[kind].place != FMU_OF_SCENE && (fmu_rows[kind].count != FMU_MODES || body->n > 0);
  }
}

/* The variables of a body in the order of their value references: how many. */
static inline int fmu_variables(fmu_variable *list, const fb_body *body, const fmu_parts *parts)
{
  int n = 0, next = 0;
  for (int kind = 0; kind < (int)FMU_KIND_COUNT; kind++) {
    const fmu_row *const row = &fmu_rows[kind];
    const int count = row->count == FMU_MODES ? body->n : row->count;
    const int from = row->place == FMU_OF_TIP, to = row->place == FMU_OF_BODY ? 1 : body->n_node;
    for (int node = from; node < to && fmu_has(body, parts, (fmu_kind)kind); node++) {
      const fmu_variable one = {.kind = (fmu_kind)kind, .node = node, .first = next, .count = count};
      list[n++] = one;
      next += count;
    }
  }
  return n;
}

/* Value of a number before anything is set. */
static inline double fmu_start(const fb_body *body, const fmu_variable *v, int element, double step)
{
  switch (v->kind) {
#if FB_WITH_GRAVITY
  case FMU_GRAVITY:
    return (double)body->gravity[element];
#endif
  case FMU_STEP:
    return step;
  case FMU_INTEGRATOR:
  case FMU_EFFECTS:
  case FMU_DAMPING:
  case FMU_STIFFNESS:
  case FMU_MASS:
  case FMU_HUB_MASS:
  case FMU_HUB_INERTIA:
    return 1;
  case FMU_START_ATTITUDE:
    return element == 0;
  default:
    (void)body;
    return v->start;
  }
}
#endif
