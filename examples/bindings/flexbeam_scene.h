/* flexbeam_scene.h - scenes (examples/scenes/README.md) behind functions of a shared library, for any language that
   calls C: open a text, set, step, read, save, linear models, modes. No struct is in it, so that what was compiled against
   it goes on with later libraries of the same fbs_interface().

     fbs *s = fbs_new();
     if (fbs_open(s, "rotor.txt", NULL, 0, NULL, NULL) != FBS_OK || fbs_step_to(s, 1.5) != FBS_OK) {
       puts(fbs_error(s)); // file:line: reason
     }
     fbs_free(s);

   Units: SI, radians; the scene's own where it says `units`. fbs_unit tells that of each number.
   Errors: a function that can fail returns a status. Where it is not FBS_OK nothing has changed (but fbs_open leaves no
     scene, fbs_run tells how far it came), fbs_error tells why and fbs_error_file, _line, _word what it is about.
     Functions that return a text, a count or an index return NULL or -1.
   Ownership: what fbs_new gives ends with fbs_free. Texts and names that functions return belong to the instance, and
     stay until it is opened again or freed (those of an error until the next one; of the linear model, modes and advice
     until they are asked for again). All that is passed in is copied.
   Threads: an instance belongs to one thread at a time, which may change; instances run in as many threads as wanted.
     They wait for each other where they read a text and build bodies.
   Memory: an instance reserves 265 MB of address space, of which the system gives what the model uses, mostly
     1 to 3 MB. */
#ifndef FLEXBEAM_SCENE_H
#define FLEXBEAM_SCENE_H
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#ifndef FBS_API
#define FBS_API
#endif

typedef struct fbs fbs;

enum fbs_status {
  FBS_OK = 0,
  FBS_REFUSED = 2, /* the motion cannot be stepped so; the state is as before */
  FBS_ERROR = 3    /* a call, a text or a number that makes no sense */
};

/* Lists of numbers that have names and units; they count from 0. */
enum fbs_list {
  FBS_PARAMETERS, /* of the scene; the first is settings.step [s], the longest step, 0 as the scene says */
  FBS_INPUTS,     /* what adds to the functions of time of loads, motors, actuators, rotors, references and motions */
  FBS_OUTPUTS,    /* the columns of the scene's CSV file behind the time */
  FBS_STATES,     /* of the linear model, where it was asked for, as are.. */
  FBS_LINEAR_INPUTS,
  FBS_LINEAR_OUTPUTS,
  FBS_POINT,      /* ..and the steady state that it is about */
  FBS_MODES,      /* their names say what moves */
  FBS_MODE_NAMES, /* flap 1, lag 1, ..; empty: it has none */
  FBS_CURVES,     /* of modes over a parameter */
  FBS_LISTS
};

/* Matrices, by rows. */
enum fbs_matrix {
  FBS_A, /* states x states.. */
  FBS_B, /* ..x linear inputs */
  FBS_C, /* linear outputs x states.. */
  FBS_D, /* ..x linear inputs */
  FBS_POINT_VALUES,
  FBS_MODE_VALUES, /* modes x 4: frequency undamped, damped [rad/s], damping ratio, growth [1/s] */
  FBS_CURVE_VALUES, /* values x (2 + 2 curves): of the parameter, spin of what spins fastest [rad/s], of each curve the damped
                       frequency [rad/s] and the growth [1/s]; not a number where it is not there */
  FBS_MATRICES
};

FBS_API int fbs_interface(void);       /* 1: of this header */
FBS_API const char *fbs_version(void); /* of flexbeam */

FBS_API fbs *fbs_new(void); /* NULL: there is no memory */
FBS_API void fbs_free(fbs *s);

/* Reads a scene: the text, which `name` names in messages and beside which the files lie that it names; NULL: the file
   `name`. n parameters have other values than there. An instance may be opened again. */
FBS_API int fbs_open(fbs *s, const char *name, const char *text, int n, const char *const *parameter,
                     const double *value);

FBS_API const char *fbs_error(const fbs *s);
FBS_API const char *fbs_error_file(const fbs *s); /* empty: it is about none */
FBS_API int fbs_error_line(const fbs *s);         /* 0: about none */
FBS_API const char *fbs_error_word(const fbs *s); /* of that line, or the name that was passed; empty: none */

FBS_API int fbs_count(const fbs *s, int list);
FBS_API const char *fbs_name(fbs *s, int list, int k);
FBS_API const char *fbs_unit(fbs *s, int list, int k);    /* "-": none */
FBS_API int fbs_find(fbs *s, int list, const char *name); /* -1: there is none */

/* Numbers of parameters, inputs or outputs: those of these indices, or where `index` is NULL the first n. Parameters are
   set before the first step alone, or after fbs_reset. Inputs hold until they are set again; all begin at 0. */
FBS_API int fbs_set(fbs *s, int list, int n, const int *index, const double *value);
FBS_API int fbs_get(fbs *s, int list, int n, const int *index, double *value);

FBS_API double fbs_time(const fbs *s); /* [s] */
FBS_API double fbs_duration(fbs *s);   /* [s] of the scene; 0: it computes its start alone */
FBS_API double fbs_interval(fbs *s);   /* [s] of its rows */

/* Steps up to a time, in steps of the scene's own. From a row to a later row of the scene: with the bits of its run. */
FBS_API int fbs_step_to(fbs *s, double time);

/* From where it is, n rows of the scene, each into 1 + outputs numbers: time and outputs. made: how many there are then,
   fewer than n where the status is not FBS_OK. */
FBS_API int fbs_run(fbs *s, int n, double *rows, int *made);

FBS_API int fbs_reset(fbs *s); /* as it was opened: time 0, parameters and inputs too */

/* All that changes, parameters and inputs too, as bytes: bytes NULL tells in *size how many. They fit every instance of
   the same text, in this and later processes of the same library. */
FBS_API int fbs_save(fbs *s, void *bytes, size_t room, size_t *size);
FBS_API int fbs_restore(fbs *s, const void *bytes, size_t size);

/* About the start of the scene, with the present parameters and inputs of 0; the state stays as it is. fbs_linear fills the
   lists of states, linear inputs and outputs and of the point, the matrices A to D and the values of the point; fbs_modes
   the list and the values of modes, slowest first. n: numbers of the matrix. */
FBS_API int fbs_linear(fbs *s);
FBS_API int fbs_modes(fbs *s);
/* Modes at n values of a parameter, followed by their shapes: fills the list and the values of curves. */
FBS_API int fbs_campbell(fbs *s, const char *parameter, double from, double to, int n);
FBS_API int fbs_matrix(fbs *s, int matrix, double *to, size_t n);

/* Effects, modes, integrator and step as the scene chooses them, what may be wrong; NULL: it has no start. */
FBS_API const char *fbs_advice(fbs *s);
/* What that told last as JSON, a field for each number, with units: integrator, step, steps, bodies by name; NULL: nothing. */
FBS_API const char *fbs_advice_json(const fbs *s);

#ifdef __cplusplus
}
#endif
#endif
