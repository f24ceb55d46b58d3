/* trace.h - the rates of a model and their Jacobian as C of its own, found by letting the library compute with numbers
   that remember how they were made (trace.cpp). */
#ifndef TRACE_H
#define TRACE_H
#include <stddef.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Nodes of a body. */
enum { NODE_SET = 96 };

typedef struct node_set {
  unsigned bits[NODE_SET / 32];
} node_set;

static inline int node_is_in(const node_set *s, int node)
{
  return (int)(s->bits[node / 32] >> node % 32 & 1u);
}

static inline void node_put(node_set *s, int node)
{
  s->bits[node / 32] |= 1u << node % 32;
}

/* Numbers of bodies on joints that are places of a table, model->k: where they stand in memory, the bodies one behind the other,
   then the system. */
typedef struct trace_table {
  int n, n_place;
  const size_t *offset;
  const int *place; /* -1: the number is what it is */
} trace_table;

typedef struct trace_choice {
  const char *name, *file; /* prefix of all names; what the model is from */
  int single;              /* 1: float */
  int vary; /* bits: factors of stiffness, damping ratios, mass, hub_mass, hub_inertia (fb_body_factors) vary */
  const node_set *loads, *sensors;              /* by body */
  const char *const *body;                      /* names; of a single body NULL */
  const char *(*node_name)(int body, int node); /* "": none */
  const unsigned char *pulls;                   /* 1: the spring of that number has an actuator */
  int implicit;                                 /* 1: the step of SDIRK in place of that of rk4 */
  const double *hub; /* where masses vary: the hub's mass, center and inertia as fb_body_factors has them; NULL: none */
  const trace_table *table; /* NULL: none; with one motors and prescribed axes are all that acts */
  int wide;                 /* 1: the step of all lanes at once by vectors, and nothing else */
} trace_choice;

/* Copies of the library's structs, of the caller's configuration, whose sizes tell whether it is that of trace.cpp. */
typedef struct trace_model {
  const void *body, *system, *state; /* of a single body system and state are NULL */
  size_t body_size, system_size, state_size;
  int n_body; /* models */
} trace_model;

/* 0, or 1 with why in text. */
int trace_write(FILE *out, const trace_choice *choice, const trace_model *model, char text[400]);

/* The functions of the step of a single body or of bodies on joints that code_body.h or code_tree.h has declared; the same in single precision. */
int trace_step(FILE *out, const trace_choice *choice, const trace_model *model, char text[400]);
int trace_step_single(FILE *out, const trace_choice *choice, const trace_model *model, char text[400]);

/* How many numbers of a body vary with these factors: the length of model->k. By precision. */
int trace_places(const trace_choice *choice, const trace_model *model);
int trace_places_single(const trace_choice *choice, const trace_model *model);

#ifdef __cplusplus
}
#endif
#endif
