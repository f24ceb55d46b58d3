/* scene_parts.h - what a scene is made of. See scene.h. */
#ifndef SCENE_PARTS_H
#define SCENE_PARTS_H
#include "../tools/capacities.h"
#include "../../flexbeam.h"
#include "../tools/model.h"
#include "../common/clear.h"
#include "../common/csv.h"
#include "function.h"
#include "control.h"
#include "../tools/exact_text.h"
#include <stddef.h>

#define SCENE_NODES (FB_MAX_NODES - 1) /* of a body, with names; what is left is for drawing */
#define SCENE_PARAMETERS 64
#define SCENE_OUTPUTS 64
#define SCENE_MEASURES 64
#define SCENE_LOADS FB_MAX_LOADS
#define SCENE_MOTIONS 12
#define SCENE_DISTRIBUTED 8
#define SCENE_GAUGES 4
#define SCENE_JOINTS (FB_MAX_BODIES + FB_MAX_LOOPS)
#define SCENE_DRIVES 64
#define SCENE_ROTORS 48 /* of all bodies */
#define SCENE_EVENTS 32
#define SCENE_CONTROLS 16
#define SCENE_COMMANDS 48     /* of all controllers */
#define SCENE_SENSORS 24      /* of a controller */
#define SCENE_BLOCKS 12       /* of it */
#define SCENE_TURNS 3         /* of its reference attitude */
#define SCENE_LATE 60         /* samples: the longest delay */
#define SCENE_REMEMBERED 8192 /* numbers that controllers remember from sample to sample */
#define SCENE_ACTS 64         /* actuators of all allocations */
#define SCENE_ALLOCATIONS (SCENE_CONTROLS + 16)

/* What runs is static, one scene at a time. With SCENE_SEVERAL each of it is where a pointer of the thread says, which who
   includes this sets. */
#ifdef SCENE_SEVERAL
#define SCENE_RUNS(type, name, dimension) static FBI_THREAD type *name##_now
#define engine (*engine_now)
#define exact_run (*exact_run_now)
#define timing (*timing_now)
#define controlling controlling_now
#define remembered remembered_now
#else
#define SCENE_RUNS(type, name, dimension) static type name dimension
#endif

typedef struct scene_setting { /* a parameter that is not to have the file's value */
  const char *name;
  double value;
} scene_setting;

typedef struct scene_body {
  char name[TEXT_NAME];
  int line, base_line; /* where it begins; `base`, 0: not here */
  text_words seen;     /* of its words, those that are the scene's */
  model_kind kind;
  fb_shape shape; /* of all its modes */
  fb_body_desc level;
  int rests;                     /* it has natural modes of rest */
  fb_root root;                  /* of modes that leave out how it moves, else clamped */
  fb_real turn[FB_MAX_MODES][3]; /* of a root that is pinned: how each mode turns it */
  fb_form_desc form;             /* of a body alone */
  fb_form_torque torque;         /* of its shape, where that form wants it */
  int n_node;                    /* with node 0; further ones of the shape are drawn: */
  int n_beam, n_drawn;           /* of each of its beams so many, from the root on */
  int on_beam[FB_MAX_NODES];     /* is the node on one of them? */
  char node_name[FB_MAX_NODES][TEXT_NAME];
  exact_spot node_at[FB_MAX_NODES]; /* of an exact beam, and.. */
  int element_node[FB_MAX_NODES];   /* ..which of its nodes */
  double tolerance;                 /* of `auto`; 0: effects as given */
  double position[3], attitude[4], velocity[3], spin[3], q[FB_MAX_MODES], q_dot[FB_MAX_MODES]; /* at the start */
  char warning[sizeof model.warning], doubt[sizeof model.doubt]; /* doubt: where units are SI */
  int n_gauge;
  char gauge_name[SCENE_GAUGES][TEXT_NAME];
  fb_gauge gauge[SCENE_GAUGES];
} scene_body;

typedef struct scene_load { /* vector times function */
  int body, node, torque;
  int nudge; /* it acts while the steady state is looked for */
  int act;   /* what is commanded is the function; -1: nothing is */
  fb_axes axes;
  double vector[3];
  function f;
} scene_load;

typedef struct scene_distributed { /* along the beam of a body, per length: vector at its root to end at its tip */
  int line, body, torque, follower;
  double vector[3], end[3];
  function f;
} scene_distributed;

typedef struct scene_motion { /* of a prescribed base, body axes */
  int rate;                   /* [rad/s], else a velocity [m/s] */
  int support, node;          /* of what holds an exact beam at a node: rotation [rad], else displacement [m] */
  double vector[3];
  function f;
} scene_motion;

typedef struct scene_joint {
  char name[TEXT_NAME];
  int line;
  text_words seen;
  int loop; /* it closes one */
  int at;   /* its number in the system: that of the body it carries, of a loop the number of bodies and its own */
  fb_joint_desc desc;
  double orientation[4]; /* of the child at zero coordinates, to the axes of the parent's node */
  double start[3], speed[3];
} scene_joint;

typedef enum scene_drive_kind { SCENE_MOTOR, SCENE_VALUE, SCENE_SPEED } scene_drive_kind;

typedef struct scene_drive { /* of an axis of a joint */
  scene_drive_kind kind;
  int line, joint, axis;
  int act; /* what is commanded is the function; -1: nothing is */
  function f;
} scene_drive;

typedef struct scene_spring { /* between two points */
  char name[TEXT_NAME];
  int line, pulls; /* it has an actuator */
  text_words seen;
  fb_spring desc;
  function pull;
  int act; /* the last one that is commanded to add to it; -1: none */
} scene_spring;

typedef struct scene_rotor { /* the rest of it is in the level of its body */
  rotor_text text;
  int body, at; /* at: which one of the body */
  function f;   /* motor; momentum, where it is given */
  int act;      /* the last one that is commanded to add to the motor; -1: none */
} scene_rotor;

typedef struct scene_event { /* an axis is locked, freed or prescribed */
  double t;
  int line, joint, axis;
  fb_axis_mode mode;
} scene_event;

typedef enum scene_actor { SCENE_BY_NONE, SCENE_BY_MOTOR, SCENE_BY_PULL, SCENE_BY_LOAD, SCENE_BY_ROTOR } scene_actor;

typedef struct scene_act { /* a motor, actuator, load or rotor that is commanded */
  scene_actor actor;
  int at;                                  /* number of its drive, spring, load or rotor */
  int next;                                /* the one before that drives the same spring or rotor; -1: none */
  double gain[CONTROL_SIGNALS], low, high; /* of each command; least and most that it takes */
  char unit[32];
} scene_act;

typedef struct scene_allocation { /* of commands to actuators */
  char name[TEXT_NAME];           /* empty: of the output of a controller */
  int line, n, first, n_act;      /* n: commands; acts first.. */
} scene_allocation;

typedef struct scene_attitude { /* what a controller of attitude sees and wants */
  int is, line;
  int body, node, gyro_body, gyro_node;
  double wanted[4];
  int n_turn; /* one after the other, behind `wanted` */
  struct {
    double axis[3];
    function f; /* [rad] */
  } turn[SCENE_TURNS];
} scene_attitude;

typedef struct scene_control { /* a sampled controller */
  char name[TEXT_NAME];
  int line;
  text_words seen;
  double sample, delay;  /* [s] */
  int n_signal, n_block; /* signals that come in: reference less what sensors see */
  int n_sensor;
  struct {
    int output;
    double gain[CONTROL_SIGNALS], step; /* step: of its numbers, 0: none */
  } sensor[SCENE_SENSORS];
  function reference[CONTROL_SIGNALS];
  int shape_first, n_shape,
      shape_length; /* of the references: pairs of delay in samples and factor, among the numbers */
  scene_attitude attitude;
  control_block block[SCENE_BLOCKS];
  int allocation, to, n_command; /* commands to.. of the allocation */
  /* where it remembers what acts, orders that are under way (time, command, value), references, and blocks theirs */
  int acting, orders, room, references, memory;
  char unit[32];
} scene_control;

typedef enum scene_place {
  SCENE_AT_NODE,
  SCENE_AT_BODY,
  SCENE_AT_MODE,
  SCENE_AT_GAUGE,
  SCENE_AT_JOINT, /* x, y, z */
  SCENE_AT_AXIS,  /* of a joint */
  SCENE_AT_SPRING,
  SCENE_AT_ROTOR,
  SCENE_AT_CONTROL,
  SCENE_AT_ALLOCATION,
  SCENE_AT_ALL
} scene_place;

typedef enum scene_quantity {
  SCENE_DISPLACEMENT,
  SCENE_ROTATION,
  SCENE_POSITION,
  SCENE_VELOCITY,
  SCENE_ACCELERATION,
  SCENE_RATE,
  SCENE_RATE_DOT,
  SCENE_SPECIFIC_FORCE,
  SCENE_GYRO,
  SCENE_INTERNAL_FORCE, /* of exact beams and of modal ones with large deflection: */
  SCENE_INTERNAL_MOMENT,
  SCENE_SPIN,
  SCENE_ATTITUDE,
  SCENE_REACTION_FORCE,
  SCENE_REACTION_TORQUE,
  SCENE_MODE,
  SCENE_MODE_RATE,
  SCENE_STRAIN,
  SCENE_JOINT_FORCE,
  SCENE_JOINT_TORQUE,
  SCENE_COORDINATE,
  SCENE_COORDINATE_RATE,
  SCENE_COORDINATE_ACCELERATION,
  SCENE_DRIVE,
  SCENE_LENGTH,
  SCENE_TENSION,
  SCENE_ROTOR_SPEED,
  SCENE_ROTOR_MOMENTUM,
  SCENE_COMMAND,
  SCENE_ALLOCATED,
  SCENE_ENERGY,
  SCENE_MOMENTUM,
  SCENE_ANGULAR_MOMENTUM,
  SCENE_POWER
} scene_quantity;

static const struct scene_quantity_row {
  const char *name, *unit;
  scene_place place;
  const char *axes[5];
} scene_quantities[] = {{"displacement", "m", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"rotation", "rad", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"position", "m", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"velocity", "m/s", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"acceleration", "m/s^2", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"rate", "rad/s", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"rate_dot", "rad/s^2", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"specific_force", "m/s^2", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"gyro", "rad/s", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"internal_force", "N", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"internal_moment", "N m", SCENE_AT_NODE, {"x", "y", "z"}},
                        {"spin", "rad/s", SCENE_AT_BODY, {"x", "y", "z"}},
                        {"attitude", "-", SCENE_AT_BODY, {"w", "x", "y", "z"}},
                        {"reaction_force", "N", SCENE_AT_BODY, {"x", "y", "z"}},
                        {"reaction_torque", "N m", SCENE_AT_BODY, {"x", "y", "z"}},
                        {"mode", "sqrt(kg) m", SCENE_AT_MODE, {NULL}},
                        {"mode_rate", "sqrt(kg) m/s", SCENE_AT_MODE, {NULL}},
                        {"strain", "-", SCENE_AT_GAUGE, {NULL}},
                        {"joint_force", "N", SCENE_AT_JOINT, {"x", "y", "z"}},
                        {"joint_torque", "N m", SCENE_AT_JOINT, {"x", "y", "z"}},
                        {"coordinate", "rad", SCENE_AT_AXIS, {NULL}},
                        {"speed", "rad/s", SCENE_AT_AXIS, {NULL}},
                        {"joint_acceleration", "rad/s^2", SCENE_AT_AXIS, {NULL}},
                        {"drive", "N m", SCENE_AT_AXIS, {NULL}},
                        {"length", "m", SCENE_AT_SPRING, {NULL}},
                        {"tension", "N", SCENE_AT_SPRING, {NULL}},
                        {"rotor_speed", "rad/s", SCENE_AT_ROTOR, {NULL}},
                        {"rotor_momentum", "N m s", SCENE_AT_ROTOR, {NULL}},
                        {"command", "-", SCENE_AT_CONTROL, {NULL}},
                        {"allocated", "-", SCENE_AT_ALLOCATION, {NULL}},
                        {"energy", "J", SCENE_AT_ALL, {"total", "kinetic", "strain", "gravity"}},
                        {"momentum", "N s", SCENE_AT_ALL, {"x", "y", "z"}},
                        {"angular_momentum", "N m s", SCENE_AT_ALL, {"x", "y", "z"}},
                        {"power", "W", SCENE_AT_ALL, {NULL}}};
#define SCENE_QUANTITIES ((int)(sizeof scene_quantities / sizeof scene_quantities[0]))

typedef struct scene_output {
  char label[TEXT_NAME];
  scene_quantity quantity;
  int body, at, axis; /* at: node, mode, gauge, joint, spring, rotor, controller or act; axis: or command */
  char unit[32];
} scene_output;

typedef enum scene_kind {
  SCENE_MAX,
  SCENE_MIN,
  SCENE_MEAN,
  SCENE_RMS,
  SCENE_FINAL,
  SCENE_FREQUENCY,   /* of the spectrum about the start: */
  SCENE_GROWTH,      /* the fastest of so many */
  SCENE_GAIN_MARGIN, /* of the loop of a controller about the start: */
  SCENE_GAIN_REDUCTION,
  SCENE_PHASE_MARGIN,
  SCENE_DELAY_MARGIN,
  SCENE_POLE_RADIUS,
  SCENE_RETURN_DIFFERENCE
} scene_kind;
static const char *const scene_kinds[] = {"max",
                                          "min",
                                          "mean",
                                          "rms",
                                          "final",
                                          "frequency",
                                          "growth",
                                          "gain_margin",
                                          "gain_reduction",
                                          "phase_margin",
                                          "delay_margin",
                                          "pole_radius",
                                          "return_difference",
                                          NULL};
static const char *const scene_kind_units[] = {"rad/s", "1/s", "-", "-", "rad", "s", "-", "-"}; /* from frequency on */

typedef struct scene_measure {
  char label[TEXT_NAME];
  int line;
  scene_kind kind;
  int output;                     /* or mode of the spectrum, among those chosen by: mode, part; or controller */
  int command;                    /* of it, from 1; 0: all */
  double after;                   /* [s] */
  double near;                    /* [rad/s] the mode of the frequency nearest to that; 0: by number */
  char mode[64], part[TEXT_NAME]; /* the mode of that name; those in which that joint or body has most; empty: any */
} scene_measure;

/* Is it the frequency of a mode that is not chosen by its number among all? */
static inline int scene_is_chosen(const scene_measure *m)
{
  return m->near > 0 || m->mode[0] || m->part[0];
}

typedef struct scene_expectation { /* of a measure */
  int line, measure, relative;
  double value, tolerance, difference; /* difference: by scene_run */
} scene_expectation;

typedef struct scene_reference { /* of an output, rows of a table */
  int line, output, relative;
  function table;
  double factor, tolerance, from, to, difference, largest;
  int next, compared; /* difference, largest of the table: by scene_run */
} scene_reference;

typedef enum scene_view_from { /* which axes are right and up on a page */
                               SCENE_VIEW_ANY,
                               SCENE_VIEW_TOP,   /* x, y */
                               SCENE_VIEW_FRONT, /* x, z */
                               SCENE_VIEW_SIDE,  /* y, z */
                               SCENE_VIEW_ASLANT
} scene_view_from;

typedef struct scene {
  char warning[TEXT_MESSAGE]; /* by scene_run: the first one; empty: none */
  text_fault fault;           /* of the message */
  char message[TEXT_MESSAGE], path[512], title[128], length_unit[8], force_unit[8];
  int n_parameter;
  text_named parameter[SCENE_PARAMETERS];
  char parameter_words[SCENE_PARAMETERS][64]; /* behind its value: unit, meaning */
  double duration, interval, step, dt;        /* [s]; step 0: chosen; dt: by scene_run */
  fb_integrator integrator;
  int integrator_auto;
  double gravity[3];
  int trim; /* starts in its steady state */
  scene_view_from view;
  int view_of; /* body in whose frame it is seen; -1: at rest */
  fb_method method;
  int n_body, n_load, n_motion, n_output, n_measure, n_joint, n_loop, n_drive, n_spring, n_rotor, n_event, n_control,
      n_allocation, n_act, n_remembered, n_expectation, n_reference, n_distributed;
  scene_load load[SCENE_LOADS];
  scene_distributed distributed[SCENE_DISTRIBUTED];
  scene_motion motion[SCENE_MOTIONS];
  scene_output output[SCENE_OUTPUTS];
  scene_measure measure[SCENE_MEASURES];
  double measured[SCENE_MEASURES]; /* by scene_run */
  scene_joint joint[SCENE_JOINTS];
  scene_drive drive[SCENE_DRIVES];
  scene_spring spring[FB_MAX_SPRINGS];
  scene_rotor rotor[SCENE_ROTORS];
  scene_event event[SCENE_EVENTS];
  scene_control control[SCENE_CONTROLS];
  scene_allocation allocation[SCENE_ALLOCATIONS];
  scene_act act[SCENE_ACTS];
  scene_expectation expectation[SCENE_MEASURES];
  scene_reference reference[SCENE_OUTPUTS];
  int missed; /* expectations, references and estimates of auto beyond their tolerance, by scene_run */
  int exact_elements, is_exact; /* elements of `exact` for a beam of modes, 0: none; the body is an exact beam */
  exact_text exact;
  function_tables tables;
  control_numbers numbers;
  text_words seen;
  const scene_setting *set;
  int n_set;
  int began;                      /* by scene_run: the start was found; what failed before is in the file */
  scene_body body[FB_MAX_BODIES]; /* last: each is cleared where it is read, memory of others is not looked at */
} scene;

/* A reason in the scene's message, about a line of it; line 0: about the whole. Returns 1. */
static int scene_fail_list(scene *s, int line, const char *format, va_list list)
{
  const int n = snprintf(s->message, sizeof s->message, line > 0 ? "%.400s:%d: " : "%.400s: ", s->path, line);
  vsnprintf(s->message + n, sizeof s->message - (size_t)n, format, list);
  text_blame(&s->fault, s->path, line, "");
  return 1;
}

static int scene_fail_at(scene *s, int line, const char *format, ...)
{
  va_list list;
  va_start(list, format);
  scene_fail_list(s, line, format, list);
  va_end(list);
  return 1;
}

static int scene_fail(scene *s, const char *format, ...)
{
  va_list list;
  va_start(list, format);
  scene_fail_list(s, 0, format, list);
  va_end(list);
  return 1;
}

/* What may be wrong with a run that goes on: to `warn`, if that is asked for. */
static void scene_warn(scene *s, FILE *warn, const char *format, ...)
{
  char text[TEXT_MESSAGE];
  va_list list;
  va_start(list, format);
  vsnprintf(text, sizeof text, format, list);
  va_end(list);
  if (warn) {
    fprintf(warn, "%s: %s\n", s->path, text);
  }
  if (!s->warning[0]) {
    memcpy(s->warning, text, sizeof text);
  }
}

typedef struct scene_view { /* what outputs are taken from; of one body: pose[0], motion[0] */
  fb_system_motion motion;
  fb_energy energy;
  fb_momentum momentum;
} scene_view;

static void scene_reals(fb_real *x, const double *value, int n)
{
  for (int i = 0; i < n; i++) {
    x[i] = (fb_real)value[i];
  }
}

struct scene_controlling { /* what a controller knows */
  long sampled;            /* so many times */
  int first, n;            /* orders that are under way, a ring */
};
SCENE_RUNS(struct scene_controlling, controlling, [SCENE_CONTROLS]);

/* What acts, by the number of an act; of each allocation the factor that its limits leave; then what controllers remember. */
SCENE_RUNS(double, remembered, [SCENE_REMEMBERED]);

/* A load at t, of the piece that holds `side`. */
static fb_load scene_load_at(const scene *s, const scene_load *l, double t, double side)
{
  const double f = l->act < 0 ? function_eval(&l->f, &s->tables, t, side).value : remembered[l->act];
  fb_load load;
  memset(&load, 0, sizeof load);
  load.node = l->node;
  load.axes = l->axes;
  for (int i = 0; i < 3; i++) {
    (l->torque ? load.torque : load.force)[i] = (fb_real)(f * l->vector[i]);
  }
  return load;
}
#endif
