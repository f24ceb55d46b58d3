/* laws.h - laws that every model keeps, held against random legal models (tests/laws).
   A kind of model (body, system, exact beam) is a list of features, a function that draws a model from them, and a list
   of laws that need no reference: conservation, derivatives, invariance, one method against another. laws.c covers every
   pair of features, draws, asks, halves the step where a law takes differences, and shrinks what fails. */
#ifndef FBL_LAWS_H
#define FBL_LAWS_H

#include "../../flexbeam.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FBL_FEATURES = 24, FBL_LEVELS = 10 };

#define FBL_COUNT(array) ((int)(sizeof(array) / sizeof((array)[0])))

typedef struct fbl_feature {
  const char *name;
  /* Level 0: without it, or the simplest; NULL behind the last. Those that begin with + are none of digests, which are
     compared with those of versions before them. */
  const char *level[FBL_LEVELS];
} fbl_feature;

/* What a law returns instead of a miss. */
#define FBL_NONE (-1.0)    /* it says nothing of this model */
#define FBL_REFUSED (-2.0) /* the library refused: fbl_refuse has noted which call, and its status */

typedef struct fbl_law {
  const char *name;
  const char *ids; /* equations that it proves */
  /* By how much the drawn model misses the law, relative to the size of what is compared. h: step of differences, in
     units of the longest stable step of rk4. */
  double (*miss)(double h);
  double h;        /* first step, halved as long as that lessens a miss above the bound; 0: none */
  double bound[2]; /* in double, in single precision; 0: not asked in that precision */
} fbl_law;

typedef struct fbl_kind {
  const char *name;
  const fbl_feature *feature;
  int n_feature;
  void (*legal)(int *level);           /* lowers the levels that do not go together */
  fb_status (*draw)(const int *level); /* makes the model and its state as fbl_view has them; streams are its numbers */
  const fbl_law *law;
  int n_law;
  fb_status (*digest)(void); /* runs the drawn model for a while and tells by fbl_say what became of it. NULL: none */
} fbl_kind;

extern const fbl_kind fbl_body, fbl_system, fbl_exact;

/* ---- random numbers: a stream of its own for each use, so that a feature that is left out changes no other number */
void fbl_stream(const char *use);
double fbl_in(double from, double to);
int fbl_pick(int n);   /* 0 .. n - 1 */
extern int fbl_number; /* of the body that is drawn: part of its streams */

/* ---- how the scene is seen: what a law changes before it draws the same model once more. Laws that change it call
   fbl_plain before they return. */
typedef struct fbl_view {
  double kg, m, s; /* one of the drawn units in those of the model: powers of two */
  int mirror;      /* all y reversed */
  int reverse;     /* loads, parts, bodies in reverse order */
  int undeformed;  /* the motion starts without elastic deflection: modes of a mirror image have signs of their own */
  double turn[4], shift[3], boost[3]; /* of the scene in the inertial frame; shift [m], boost [m/s] in drawn units */
} fbl_view;
extern fbl_view fbl_seen;
extern const fbl_view fbl_turned, fbl_other_units, fbl_mirrored, fbl_reordered;
void fbl_plain(void);
/* x with the unit kg^a m^b s^c */
fb_real fbl_unit(double x, int kg, int m, int s);
/* Vectors of the body: displacements, forces (polar); rotations, moments (axial), with units. */
void fbl_polar(fb_real *out, double x, double y, double z, int kg, int m, int s);
void fbl_axial(fb_real *out, double x, double y, double z, int kg, int m, int s);
/* The same of inertial vectors, turned with the scene. */
void fbl_inertial_polar(fb_real *out, double x, double y, double z, int kg, int m, int s);
void fbl_inertial_axial(fb_real *out, double x, double y, double z, int kg, int m, int s);
/* A quaternion of the drawn scene as it is seen: mirrored; turned: of a pose in the inertial frame. */
void fbl_quat(fb_real *out, const double q[4], int turned);

/* ---- for laws */
double fbl_refuse(const char *call, fb_status status); /* notes it, returns FBL_REFUSED */
/* What the last refusal says, its value found and its bound over `unit`; "" where the library keeps no records. */
const char *fbl_record(double *have, double *need, double unit);
/* Overwrites one of the reals that fit into `size` bytes by what is no number, and as integers beyond every count. */
void fbl_spoil(void *model, size_t size);
void fbl_flip(void *model, size_t size); /* one of its bits */
/* Largest |a_i - b_i|, largest |a_i|. */
double fbl_difference(const fb_real *a, const fb_real *b, int n);
double fbl_largest(const fb_real *a, int n);
static inline double larger(double a, double b)
{
  return a > b ? a : b;
}
static inline double dot(const fb_real *a, const fb_real *b)
{
  return (double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] + (double)a[2] * (double)b[2];
}
static inline void to_inertial(fb_real *out, const fb_real quat[4], const fb_real *x)
{
  fb_real R[9];
  fb_quat_to_mat33(R, quat);
  fb_mat33_mul_vec3(out, R, x);
}
/* Outputs of a linear model after n steps of rk4 from rest under a constant u at one of its inputs. */
void fbl_respond(double y[FB_MAX_PORTS], const fb_linear *linear, int input, double u, double step, int n);
/* Derivative in the middle of five values x[0 .. 4] that lie `stride` reals apart, h between them: order 4. */
double fbl_slope(const fb_real *x, size_t stride, double h);
/* Rate of rotation in the middle of five attitudes, inertial axes. */
void fbl_turning(double w[3], const fb_real *quat, size_t stride, double h);
/* The model of the present draw once more, after a change of fbl_seen. */
fb_status fbl_draw_again(void);
int fbl_level(const char *feature); /* of the present draw */

/* What is wrong with a description, a state, an input: where `at` holds `wrong`, `call` refuses with `expected` and leaves
   `made` as it was. Counts the rows that hold otherwise; build/laws --verbose names them. */
void fbl_wrong_begin(const void *made, size_t size);
int fbl_wrong_end(const char *row, fb_status status, fb_status expected);
#define FBL_WRONG(count, at, wrong, expected, call, made)                           \
  do {                                                                              \
    unsigned char fbl_was_[sizeof(at)];                                             \
    fb_status fbl_answer_;                                                          \
    memcpy(fbl_was_, &(at), sizeof(at));                                            \
    fbl_wrong_begin(&(made), sizeof(made));                                         \
    (at) = (wrong);                                                                 \
    fbl_answer_ = (call);                                                           \
    memcpy(&(at), fbl_was_, sizeof(at));                                            \
    (count) += fbl_wrong_end(#call ": " #at " = " #wrong, fbl_answer_, (expected)); \
  } while (0)
#define FBL_NAN ((fb_real)NAN)

/* A number of a digest, over the size of what it is one of: single precision prints the same to its accuracy. */
void fbl_say(double value, double size);
/* The power of two at or below a step: the same in both precisions, whose limits differ by rounding. */
double fbl_step(double longest);

/* ---- bodies, alone and in systems (draw.c) */
enum { FBL_FULL, FBL_RIGID, FBL_LINEAR, FBL_SPIN, FBL_LARGE, FBL_STRAIN };                /* effects */
enum { FBL_UNIFORM, FBL_TAPER, FBL_TWIST, FBL_OFFSET };                                   /* section */
enum { FBL_BOTH, FBL_ONE_PLANE, FBL_TORSION, FBL_AXIAL };                                 /* modes */
enum { FBL_NATURAL, FBL_COMPONENT, FBL_ELEMENTS, FBL_FUNCTIONS, FBL_SPUN, FBL_ATTACHED }; /* basis */
enum { FBL_NO_LUMP, FBL_POINT, FBL_TENSOR, FBL_SEVERAL };                                 /* lumps */
enum { FBL_ONE_BEAM, FBL_TWO_BEAMS, FBL_WELDED, FBL_CURVED };                             /* parts */
enum { FBL_NO_IMPORT, FBL_PARTICLES, FBL_LUMPS, FBL_STIFFENED, FBL_FIELDS };              /* import */
enum { FBL_NO_ROTOR, FBL_ON_HUB, FBL_ON_BOOM, FBL_RUBBING, FBL_UNBALANCED, FBL_GIVEN };   /* rotors */
enum { FBL_NO_GRAVITY, FBL_GRAVITY, FBL_CENTER };                                         /* gravity */

typedef struct fbl_choice { /* levels of the features of a body */
  int base, effects, section, modes, shear, basis, lumps, parts, import, rotors, gravity, damping, hub;
} fbl_choice;
#define FBL_BODY_FEATURES                                                                                             \
  {"base", {"free", "prescribed", "pinned", "hinged"}},                                                               \
      {"effects", {"full", "rigid", "linear", "spin", "large", "strain"}},                                            \
      {"section", {"uniform", "taper", "twist", "offset"}}, {"modes", {"both", "one_plane", "torsion", "axial"}},     \
      {"shear", {"none", "shear"}}, {"basis", {"natural", "component", "elements", "functions", "spun", "attached"}}, \
      {"lumps", {"none", "point", "tensor", "several"}}, {"parts", {"one", "two", "welded", "curved"}},               \
      {"import", {"none", "particles", "lumps", "stiffened", "fields"}},                                              \
      {"rotors", {"none", "hub", "boom", "rubbing", "unbalanced", "given"}},                                          \
      {"gravity", {"none", "uniform", "center"}}, {"damping", {"none", "damped"}},                                    \
  {                                                                                                                   \
    "hub",                                                                                                            \
    {                                                                                                                 \
      "heavy", "light", "offset"                                                                                      \
    }                                                                                                                 \
  }
/* What fb_distributed was last told of the first, a middle and the last point of each body. */
typedef struct fbl_points {
  fb_real position[FB_MAX_BODIES][3][3], velocity[FB_MAX_BODIES][3][3];
  fb_real along[FB_MAX_BODIES][3][3], angular_rate[FB_MAX_BODIES][3][3]; /* along: axis x of the section */
  int told[FB_MAX_BODIES], own[FB_MAX_BODIES]; /* points of a body, and those that say that they are its own */
} fbl_points;
extern fbl_points fbl_told;
/* By how much positions and attitudes of points change otherwise than their velocities say: five of them, `stride` reals
   apart, h between; size [m] of the body. */
double fbl_points_miss(const fbl_points *told, size_t stride, double h, double size);
/* A dead load along the lines that grows towards their tips, for fb_distributed. user: their size in drawn units, double. */
fb_status fbl_wind(fb_line_point *point, int n, fb_real t, void *user);
/* How many wrong values the makers of a body take. */
int fbl_wrong_bodies(const fbl_choice *choice);
/* Lowers what does not go together. */
void fbl_legal(fbl_choice *choice);
/* A body by its choice; its last nodes are on its beams, the tip of the first one is node 1. Size: reach of its beams in
   drawn units [m]. */
fb_status fbl_make(fb_body *body, const fbl_choice *choice, double *size);
extern int fbl_missing; /* modes that were asked for and are not in the body made last */
/* The node that the scene calls k, 0 the hub: beams in reverse order have their tips in reverse order. */
int fbl_node(const fbl_choice *choice, int k);
/* Coordinates and rates that each have a hundredth of the energy of the body at a speed of one size a second. */
void fbl_deflect(fb_real *q, fb_real *q_dot, const fb_body *body, double size);

#define FBL_TRY(call)                        \
  do {                                       \
    const fb_status fbl_status_ = (call);    \
    if (fbl_status_ != FB_OK) {              \
      return fbl_refuse(#call, fbl_status_); \
    }                                        \
  } while (0)

#endif
