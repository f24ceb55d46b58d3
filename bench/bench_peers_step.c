/* bench_peers_step - what a second of the spin-up costs, at equal error, by flexbeam's fixed steps and by SUNDIALS'
   integrators with the same right-hand side, CSV on stdout. A beam of 10 m on a hub that turns with a prescribed rate
   up to 6 rad/s in 15 s, 30 s in all:
   modal   3 bending modes with the quadratic displacement
   strain  2 cubic elements, axial coordinates with nonlinear strain: stiff
   The peers are given q and pi alone, ours carry the pose, too. Their tolerance is relative, the absolute one is that
   of the largest coordinate. Steps beyond the limits of our integrators are allowed: the error judges them, too.
   Creating their memory is not timed. Every configuration runs once, then they take turns; the least time of each
   counts. Error: of the tip deflection, every 0.25 s, by its peak, against ARKODE's Fehlberg 7(8) with tolerance 1e-13,
   which CVODE's Adams with 1e-12 confirms. bench/peers.sh builds and runs it.
   Exit: 0, 1 when an integrator fails or results differ. */
#define _POSIX_C_SOURCE 200112L /* clock_gettime, uname */
#define FLEXBEAM_IMPLEMENTATION
#include "report.h"
#include "spin_up.h"
#include "../examples/common/output.h"
#include <arkode/arkode_arkstep.h>
#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_version.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#ifndef SUN_COMM_NULL /* since version 7 */
#define SUN_COMM_NULL NULL
#endif

#define ROWS 120 /* every 0.25 s */
#define INTERVAL (SPIN_UP_END / ROWS)
#define LEAST 5e-7 /* an error that ends a ladder, too */
#define MOST 25000 /* steps of a peer in an interval */
#define STEPS 5000 /* in an interval, at most */
#define LADDER 14  /* configurations of a method */
#define SAMPLES 9  /* of each */
#define SLOW 2e8   /* [ns] a run that takes longer ends its ladder */
#define TURNS 4e8  /* [ns] for the samples of a configuration */
#define EQUALS 5

enum { RK4, MIDPOINT, SDIRK, EXPONENTIAL, ADAMS, BDF, BDF2, ERK, DIRK, ERK_FIXED, METHODS, ERK_HIGH = METHODS };
enum { PEERS = ADAMS }; /* the first of them */

static const struct {
  const char *code, *name;
} methods[METHODS] = {{"flexbeam", "rk4"},
                      {"flexbeam", "midpoint"},
                      {"flexbeam", "sdirk"},
                      {"flexbeam", "exponential"},
                      {"CVODE", "Adams"},
                      {"CVODE", "BDF"},
                      {"CVODE", "BDF up to order 2"},
                      {"ARKODE", "ERK 4"},
                      {"ARKODE", "DIRK 4"},
                      {"ARKODE", "ERK 4 fixed step"}};

typedef struct configuration {
  int method;
  double parameter; /* [s] step, or tolerance */
  long evaluations;
  double error;
  int n; /* samples */
  double sample[SAMPLES];
  clock_timing time; /* [us] per simulated second */
} configuration;

static fb_body body;
static int tip; /* node */
static fb_body_work body_work;
static double q[ROWS][FB_MAX_MODES];          /* of the last run */
static double reference[ROWS], peak, largest; /* [m] tip deflection; the largest coordinate */
static configuration ladder[METHODS][LADDER];
static int rungs[METHODS];
static long evaluations; /* by a peer */
static SUNContext context;

static void require(int ok, const char *what)
{
  spin_up_require(ok, "bench_peers_step", what);
}

static void build(int modes, int n_element)
{
  static fb_shape shape;
  const boom b = {BOOM_LENGTH,           BOOM_MASS,       BOOM_EI, BOOM_EA, .planes = 1, .modes = modes,
                  .elements = n_element, .root_strain = 1};
  fb_body_desc desc;
  memset(&desc, 0, sizeof desc);
  desc.effects = n_element ? FB_EFFECTS_STRAIN : FB_EFFECTS_FULL;
  desc.base = FB_BASE_PRESCRIBED;
  desc.allow_long_step = 1;
  fbb_check(boom_shape(&shape, &tip, &b), "shape integrals");
  fbb_check(fb_body_init(&body, &body_work, &shape, &desc), "body");
}

/* ---- flexbeam: steps per interval; 0: refused or left the model */

static int run_ours(double *ns, int method, int steps)
{
  static fb_rk4_work rk4;
  static fb_implicit_work implicit;
  static fb_exponential scheme;
  static fb_exponential_work exponential;
  const fb_real dt = (fb_real)(INTERVAL / steps);
  fb_input input[3];
  fb_state state;
  fb_status status = FB_OK;
  double start;
  memset(input, 0, sizeof input);
  fbb_check(fb_state_init(&body, &state), "state");
  if (method == EXPONENTIAL) {
    fbb_check(fb_exponential_init(&scheme, &body_work, &body, dt), "exponential");
  }
  start = clock_own_ns();
  spin_up_drive(&input[0], 0.0);
  for (int k = 1; k <= ROWS * steps && status == FB_OK; k++) {
    if (method != SDIRK) {
      spin_up_drive(&input[1], (k - 0.5) * INTERVAL / steps);
    }
    spin_up_drive(&input[2], k * INTERVAL / steps);
    if (method == RK4) {
      status = fb_rk4_step(&body, &state, &rk4, &input[0], &input[1], &input[2], dt);
    } else if (method == MIDPOINT) {
      status = fb_midpoint_step(&body, &state, &implicit, &input[1], dt, 0);
    } else if (method == SDIRK) {
      status = fb_sdirk_step(&body, &state, &implicit, &input[0], &input[2], dt, 0);
    } else {
      status = fb_exponential_step(&body, &scheme, &state, &exponential, &input[0], &input[1], &input[2]);
    }
    input[0] = input[2];
    if (k % steps == 0) {
      memcpy(q[k / steps - 1], state.q, sizeof state.q);
    }
  }
  *ns = clock_own_ns() - start;
  return status == FB_OK;
}

/* ---- SUNDIALS: y = (q, pi) */

typedef struct peer {
  int method;
  fb_state state;
  void *memory;
  N_Vector y;
  SUNMatrix matrix;
  SUNLinearSolver linear;
  SUNNonlinearSolver fixed_point;
} peer;

static int right_hand_side(sunrealtype t, N_Vector y, N_Vector y_dot, void *user)
{
  const size_t bytes = sizeof(double) * (size_t)body.n;
  static fb_input input;
  static fb_state rate;
  fb_state *state = user; /* its pose stays as it is: nothing here depends on it */
  evaluations++;
  spin_up_drive(&input, t);
  memcpy(state->q, N_VGetArrayPointer(y), bytes);
  memcpy(state->pi, N_VGetArrayPointer(y) + body.n, bytes);
  if (fb_body_rates_eval(&body, &rate, state, &input) != FB_OK) {
    return 1; /* a shorter step may help */
  }
  memcpy(N_VGetArrayPointer(y_dot), rate.q, bytes);
  memcpy(N_VGetArrayPointer(y_dot) + body.n, rate.pi, bytes);
  return 0;
}

static int is_cvode(int method)
{
  return method == ADAMS || method == BDF || method == BDF2;
}

/* parameter: the tolerance, or the step. Order 4 is the default of ERKStep and ARKStep. */
static void peer_open(peer *p, int method, double parameter)
{
  const double absolute = parameter * largest;
  int bad = 0;
  memset(p, 0, sizeof *p);
  p->method = method;
  fbb_check(fb_state_init(&body, &p->state), "state");
  p->y = N_VNew_Serial(2 * body.n, context);
  N_VConst(0.0, p->y);
  if (is_cvode(method)) {
    p->memory = CVodeCreate(method == ADAMS ? CV_ADAMS : CV_BDF, context);
    bad = CVodeInit(p->memory, right_hand_side, 0.0, p->y) || CVodeSStolerances(p->memory, parameter, absolute) ||
          CVodeSetUserData(p->memory, &p->state) || CVodeSetMaxNumSteps(p->memory, MOST) ||
          (method == BDF2 && CVodeSetMaxOrd(p->memory, 2));
  } else if (method == DIRK) {
    p->memory = ARKStepCreate(NULL, right_hand_side, 0.0, p->y, context);
    bad = ARKStepSStolerances(p->memory, parameter, absolute) || ARKStepSetUserData(p->memory, &p->state) ||
          ARKStepSetMaxNumSteps(p->memory, MOST);
  } else {
    p->memory = ERKStepCreate(right_hand_side, 0.0, p->y, context);
    bad = (method == ERK_FIXED ? ERKStepSetFixedStep(p->memory, parameter)
                               : ERKStepSStolerances(p->memory, parameter, absolute)) ||
          (method == ERK_HIGH && ERKStepSetTableNum(p->memory, ARKODE_FEHLBERG_13_7_8)) ||
          ERKStepSetUserData(p->memory, &p->state) || ERKStepSetMaxNumSteps(p->memory, MOST);
  }
  if (method == ADAMS) {
    p->fixed_point = SUNNonlinSol_FixedPoint(p->y, 0, context);
    bad = bad || CVodeSetNonlinearSolver(p->memory, p->fixed_point);
  } else if (is_cvode(method) || method == DIRK) {
    p->matrix = SUNDenseMatrix(2 * body.n, 2 * body.n, context);
    p->linear = SUNLinSol_Dense(p->y, p->matrix, context);
    bad = bad || (is_cvode(method) ? CVodeSetLinearSolver(p->memory, p->linear, p->matrix)
                                   : ARKStepSetLinearSolver(p->memory, p->linear, p->matrix));
  }
  require(!bad, "SUNDIALS refuses its options");
}

static void peer_close(peer *p)
{
  if (is_cvode(p->method)) {
    CVodeFree(&p->memory);
  } else if (p->method == DIRK) {
    ARKStepFree(&p->memory);
  } else {
    ERKStepFree(&p->memory);
  }
  if (p->fixed_point) {
    SUNNonlinSolFree(p->fixed_point);
  }
  if (p->linear) {
    SUNLinSolFree(p->linear);
    SUNMatDestroy(p->matrix);
  }
  N_VDestroy(p->y);
}

static int run_peer(double *ns, int method, double parameter)
{
  peer p;
  double start, t;
  int row, status = 0;
  peer_open(&p, method, parameter);
  evaluations = 0;
  start = clock_own_ns();
  for (row = 0; row < ROWS && status >= 0; row++) {
    const double until = (row + 1) * INTERVAL;
    if (is_cvode(method)) {
      status = CVode(p.memory, until, p.y, &t, CV_NORMAL);
    } else if (method == DIRK) {
      status = ARKStepEvolve(p.memory, until, p.y, &t, ARK_NORMAL);
    } else {
      status = ERKStepEvolve(p.memory, until, p.y, &t, ARK_NORMAL);
    }
    memcpy(q[row], N_VGetArrayPointer(p.y), sizeof(double) * (size_t)body.n);
  }
  *ns = clock_own_ns() - start;
  peer_close(&p);
  return status >= 0;
}

/* ---- errors */

static double deflection(int row)
{
  fb_state state;
  fb_motion motion;
  fb_node_motion node;
  fbb_check(fb_state_init(&body, &state), "state");
  memcpy(state.q, q[row], sizeof state.q);
  fbb_check(fb_body_motion_eval(&body, &motion, &state, NULL), "motion");
  fbb_check(fb_body_node_motion_eval(&body, &node, &state, &motion, tip), "tip");
  return (double)node.displacement[1];
}

static double error_of_run(void)
{
  double most = 0;
  for (int row = 0; row < ROWS; row++) {
    const double apart = fabs(deflection(row) - reference[row]);
    most = apart <= most ? most : apart; /* what is not a number counts */
  }
  return most / peak;
}

static void find_reference(const char *scene)
{
  double ns, confirmed;
  largest = 1e-3;
  peak = 0;
  require(run_peer(&ns, ERK_HIGH, 1e-13), "the reference fails");
  for (int row = 0; row < ROWS; row++) {
    reference[row] = deflection(row);
    peak = fmax(peak, fabs(reference[row]));
    for (int a = 0; a < body.n; a++) {
      largest = fmax(largest, fabs(q[row][a]));
    }
  }
  require(run_peer(&ns, ADAMS, 1e-12), "Adams fails");
  confirmed = error_of_run();
  printf("# %s: %d coordinates, tip deflection up to %.4f m, two references differ by %.1e of it\n", scene, body.n,
         peak, confirmed);
  require(confirmed < 1e-8, "the references differ");
}

/* ---- ladders */

static int run(double *ns, const configuration *c)
{
  return c->method < PEERS ? run_ours(ns, c->method, (int)lround(INTERVAL / c->parameter))
                           : run_peer(ns, c->method, c->parameter);
}

/* Longest steps, largest tolerances first: a step is two thirds of the one before, a tolerance a tenth. ERKStep's main
   integrator is stable where rk4 is. */
static void climb(int method)
{
  static const int per_step[PEERS] = {4, 3, 5, 4};
  const int by_steps = method < PEERS || method == ERK_FIXED;
  double ns = 0, tolerance = 1e-2;
  int steps = method == ERK_FIXED ? (int)lround(INTERVAL / ladder[RK4][0].parameter) : 1, done = 0;
  rungs[method] = 0;
  while (!done && (by_steps ? steps < STEPS : tolerance > 5e-12)) {
    configuration *c = &ladder[method][rungs[method]];
    c->method = method;
    c->parameter = by_steps ? INTERVAL / steps : tolerance;
    c->n = 0;
    if (run(&ns, c)) {
      c->evaluations = method < PEERS ? (long)per_step[method] * ROWS * steps : evaluations;
      c->error = error_of_run();
      rungs[method] += c->error < 0.1; /* not what is beyond stability, or as good as that */
      done = c->error < LEAST || rungs[method] == LADDER || (rungs[method] > 0 && ns > SLOW);
    }
    steps += steps > 1 ? steps / 2 : 1;
    tolerance *= 0.1;
  }
  require(method >= PEERS || (rungs[method] > 0 && ladder[method][rungs[method] - 1].error < 1e-4),
          methods[method].name);
}

/* Samples of all configurations in turn. */
static void measure(void)
{
  for (int turn = 0; turn < SAMPLES; turn++) {
    for (int at = 0; at < METHODS * LADDER; at++) {
      configuration *c = &ladder[at / LADDER][at % LADDER];
      double ns;
      if (at % LADDER < rungs[at / LADDER] && (turn < 3 || turn * 1e3 * SPIN_UP_END * c->sample[0] < TURNS)) {
        require(run(&ns, c), "a run fails the second time");
        c->sample[c->n++] = 1e-3 * ns / SPIN_UP_END;
      }
    }
  }
}

/* Time per simulated second at an error: between two rungs both go by powers of each other. NAN: its ladder ends
   before. */
static double time_at(int method, double error)
{
  double best = (double)NAN;
  for (int k = 0; k < rungs[method]; k++) {
    const configuration *c = &ladder[method][k], *before = c - 1;
    double time = c->time.lowest;
    if (c->error > error) {
      continue;
    }
    if (k > 0 && before->error > error) {
      const double part = log(before->error / error) / log(before->error / c->error);
      time = before->time.lowest * pow(time / before->time.lowest, part);
    }
    best = best <= time ? best : time;
  }
  return best;
}

static void print_ladders(const char *scene)
{
  for (int at = 0; at < METHODS * LADDER; at++) {
    configuration *c = &ladder[at / LADDER][at % LADDER];
    if (at % LADDER < rungs[at / LADDER]) {
      c->time = clock_timing_of(c->sample, c->n);
      printf("ladder,%s,%s,%s,%.3g,%.2e,%ld,%.3f,%.3f\n", scene, methods[c->method].code, methods[c->method].name,
             c->parameter, c->error, c->evaluations, c->time.lowest, c->time.median);
    }
  }
}

static void print_equals(const char *scene)
{
  static const double errors[EQUALS] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6};
  for (int k = 0; k < EQUALS; k++) {
    int best = RK4;
    for (int method = RK4; method < PEERS; method++) {
      best = time_at(method, errors[k]) < time_at(best, errors[k]) || isnan(time_at(best, errors[k])) ? method : best;
    }
    printf("equal,%s,flexbeam,%s,,%.0e,,%.3f,", scene, methods[best].name, errors[k], time_at(best, errors[k]));
    for (int method = RK4; method < METHODS; method++) {
      printf(",%.2f", time_at(method, errors[k]) / time_at(best, errors[k]));
    }
    printf("\n");
  }
}

int main(void)
{
  static const struct {
    const char *name;
    int modes, n_element;
  } scenes[] = {{"modal", 3, 0}, {"strain", 0, 2}};
  output_begin("bench_peers_step");
  (void)fbb_begin();
  require(SUNContext_Create(SUN_COMM_NULL, &context) == 0, "SUNDIALS does not start");
  printf("# SUNDIALS %s; us of processor time per simulated second, up to %d samples in turn\n", SUNDIALS_VERSION,
         SAMPLES);
  printf("# ladder: a method at a step or a tolerance; equal: the cheapest of flexbeam at an error between the rungs, "
         "then the time of every method to it; nan: its runs take longer than %.1f s before it is so good\n",
         1e-9 * SLOW);
  printf("what,scene,code,method,step or tolerance,error,evaluations,min,median");
  for (int method = 0; method < METHODS; method++) {
    printf(",%s %s", methods[method].code, methods[method].name);
  }
  printf("\n");
  for (int k = 0; k < (int)(sizeof scenes / sizeof scenes[0]); k++) {
    build(scenes[k].modes, scenes[k].n_element);
    find_reference(scenes[k].name);
    for (int method = 0; method < METHODS; method++) {
      climb(method);
    }
    measure();
    print_ladders(scenes[k].name);
    print_equals(scenes[k].name);
  }
  SUNContext_Free(&context);
  return 0;
}
