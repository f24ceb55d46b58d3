/* trace.h - the rates of a model and their Jacobian as C of its own, found by letting the library compute with numbers
   that remember how they were made (trace.cpp). */
#ifndef TRACE_H
#define TRACE_H
#include <stddef.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct trace_choice {
  const char *name, *file;                      /* prefix of all names; what the model is from */
  int single;                                   /* 1: float */
  int vary;                                     /* 1: factors of the stiffness are inputs, 2: of damping ratios; both */
  const unsigned *loads, *sensors;              /* bits of nodes, by body */
  const char *const *body;                      /* names; of a single body NULL */
  const char *(*node_name)(int body, int node); /* "": none */
  const unsigned char *pulls;                   /* 1: the spring of that number has an actuator */
  int implicit;                                 /* 1: the step of SDIRK in place of that of rk4 */
  int wide;                                     /* 1: the step of all lanes at once by vectors, and nothing else */
} trace_choice;

/* Copies of the library's structs, of the caller's configuration, whose sizes tell whether it is that of trace.cpp. */
typedef struct trace_model {
  const void *body, *system, *state; /* of a single body system and state are NULL */
  size_t body_size, system_size, state_size;
  int n_body; /* models */
} trace_model;

/* 0, or 1 with why in text. */
int trace_write(FILE *out, const trace_choice *choice, const trace_model *model, char text[400]);

/* The functions of the step of a single body or of bodies on joints that code.h or code_tree.h has declared; the same in single precision. */
int trace_step(FILE *out, const trace_choice *choice, const trace_model *model, char text[400]);
int trace_step_single(FILE *out, const trace_choice *choice, const trace_model *model, char text[400]);

#ifdef __cplusplus
}
#endif
#endif
