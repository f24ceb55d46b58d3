/* hard.h - the suite of hard cases: what a case reports, and what cases share.
   A case is a function that runs the library where it is hard, measures one figure against its bound, and takes the
   same measure of the naive treatment: what one would write first. The row says all of it. A case holds when the figure
   is within the bound and the naive one is not: a test that the naive treatment passes tests nothing. */
#ifndef HARD_H
#define HARD_H

#define FB_MAX_MODES 40
#define FB_MAX_EXACT 60
#define FB_MAX_STRAINS 64
#include "../../flexbeam.h"
#include "../../examples/common/boom.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HARD_PI 3.14159265358979323846
#define HARD_FIRST 3.798 /* [rad/s] first bending frequency of the reference boom */
#define HARD_COUNT(array) ((int)(sizeof(array) / sizeof((array)[0])))
#define HARD_EPSILON (FB_SINGLE ? (double)FLT_EPSILON : DBL_EPSILON)
/* A bound, or a number of steps, for double and one for single precision. */
#define HARD_TOL(in_double, in_single) (FB_SINGLE ? (in_single) : (in_double))

typedef struct hard_row {
  const char *name, *what;     /* of the case */
  const char *degree;          /* how hard: a quantity and.. */
  double hard;                 /* ..its value */
  double steps, time, periods; /* [-], [s], of the slowest motion that matters; 0: does not apply */
  const char *measure;         /* what is to hold */
  double figure, bound;        /* FB_HUGE and more, or not a number: diverged or refused */
  const char *naive;           /* the naive treatment */
  double naive_figure;         /* its figure by the same measure */
  int excused;                 /* 1: this machine hides what the naive treatment costs: it need not fail */
} hard_row;

void hard_report(const hard_row *row);
/* Progress of the running case; cheap enough for every step. */
void hard_progress(double done, double whole);
/* Ends the program when the library refuses what it should take. */
void hard_must(fb_status status, const char *what);

/* ---- the cases; brief: short runs */

void hard_flat_spin(int brief);
void hard_fast_spin(int brief);
void hard_axial(int brief);
void hard_long(int brief);
void hard_long_bent(int brief);
void hard_resonance(int brief);
void hard_rounding(int brief);
void hard_decay(int brief);
void hard_latches(int brief);
void hard_massless(int brief);
void hard_loop(int brief);
void hard_column(int brief);
void hard_circle(int brief);
void hard_growth(int brief);
void hard_kicked(int brief);
void hard_thrown(int brief);
void hard_helix(int brief);
void hard_long_steps(int brief);
void hard_many_modes(int brief);
void hard_units(int brief);
void hard_absurd(int brief);
void hard_rotor(int brief);
void hard_flight(int brief);
void hard_slender(int brief);
void hard_roll(int brief);
void hard_release(int brief);

/* ---- shared */

typedef struct hard_craft { /* a beam on a rigid hub at O */
  fb_beam_desc beam;
  fb_modes_desc keep;
  fb_body_desc level;
  double hub_mass, hub_inertia[3]; /* [kg], [kg m^2] xx yy zz; no mass: no hub */
  int strain;                      /* 1: strain stations for FB_EFFECT_NONLINEAR_STRAIN */
} hard_craft;

enum { HARD_TIP = 1 }; /* node */

/* A uniform beam bending alike in both planes, cantilevered at O, full effects, free base, no hub, no modes yet. */
void hard_craft_init(hard_craft *craft, double length, double mass_per_length, double EI);
/* Axial coordinates beside those along y: three elements of functions of that degree, nonlinear strain, prescribed
   base. */
void hard_craft_stretch(hard_craft *craft, double EA, int degree);
void hard_craft_build(fb_body *body, const hard_craft *craft);
extern fb_shape hard_shape; /* of the last body built */
/* State with velocities of O and rate, body axes; q_dot NULL: none. */
void hard_start(const fb_body *body, fb_state *state, const double v[3], const double w[3], const fb_real *q_dot);
double hard_energy(const fb_body *body, const fb_state *state);
/* Elastic displacement of the tip [m], body axes. */
void hard_tip(double u[3], const fb_body *body, const fb_state *state);
double hard_difference(const fb_real *a, const fb_real *b, int n); /* largest of an element */
double hard_length(const fb_real *x);                              /* of a 3-vector */

/* state += dt rate, nothing normalized. */
void hard_advance(fb_state *state, double dt, const fb_state *rate, int n);

/* The naive treatment of many cases: explicit Euler, state + dt rate, without a check, a limit or normalization. 0
   where the rates are not to be had any more. */
int hard_euler(const fb_body *body, fb_state *state, const fb_input *input, double dt);
/* The better one: the classical integrator by the same sums, nothing normalized. */
int hard_rk4(const fb_body *body, fb_state *state, double dt);

#endif
