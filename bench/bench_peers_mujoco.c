/* bench_peers_mujoco - what a second of the spin-up costs, at equal error, by bodies of flexbeam and by MuJoCo, CSV on
   stdout, then a table. Both against the geometrically exact beam of tests/reference/p07C_second_order.csv.
   flexbeam  1 to 4 bending modes, with the quadratic displacement (full) or as modes of curvature (large), by rk4 and the
             exponential scheme
   MuJoCo    a chain of rigid links of length h on hinges with springs EI/h, the first half a link from the hub, by each of
             its integrators; the hub, of 1e9 kg m^2, is turned by the torque that the prescribed rate takes, given at every
             stage (its rate is off by less than 1e-5 rad/s)
   A ladder ends where steps no longer better the error, or where a run takes longer than 3 s. Error: of the tip deflection
   in the axes of the hub, every 0.5 s, by its peak. The least time of up to five runs counts. bench/peers.sh builds and
   runs it. Usage: bench_peers_mujoco REFERENCE MODEL, MODEL a file to write MuJoCo's model to.
   Exit: 0, 1 when either refuses something. */
#define _POSIX_C_SOURCE 200112L /* clock_gettime, uname */
#define FLEXBEAM_IMPLEMENTATION
#include "report.h"
#include "spin_up.h"
#include "../examples/common/output.h"
#include <mujoco/mujoco.h>

#define ROWS 60     /* every 0.5 s */
#define RUNGS 2000  /* of all ladders */
#define RUNS 5      /* of each rung, at most */
#define FAR 0.3     /* an error that does not count */
#define SLOW 3e9    /* [ns] a run that takes longer ends its ladder */
#define TURNS 1e9   /* [ns] for the runs of a rung */
#define INERTIA 1e9 /* [kg m^2] of the hub in MuJoCo */
#define TEXT 65536  /* characters of MuJoCo's model */
#define TOLERANCES 4
#define MODES_MOST 4

enum { FLEXBEAM, MUJOCO, CODES };
static const char *const code_name[CODES] = {"flexbeam", "MuJoCo"};

typedef struct rung {
  int code;
  char method[48];
  double step, error, time; /* [s], by the peak, [us] of processor time per simulated second */
} rung;

static rung rungs[RUNGS];
static int n_rung;
static double reference[ROWS], peak, deflection[ROWS]; /* [m] */

static void require(int ok, const char *what)
{
  spin_up_require(ok, "bench_peers_mujoco", what);
}

/* Columns t and GE_u2 of the reference, every 0.5 s from 0.5 s on. */
static void read_reference(const char *path)
{
  static char line[16384];
  FILE *file = fopen(path, "r");
  int row = 0;
  require(file != NULL, "cannot read the reference");
  while (fgets(line, sizeof line, file) && row < ROWS) {
    double t, u1, u2;
    if (line[0] != '#' && sscanf(line, "%lf,%lf,%lf", &t, &u1, &u2) == 3 && t > 0) {
      require(fabs(t - 0.5 * (row + 1)) < 1e-9, "the reference has other times");
      reference[row++] = u2;
      peak = fmax(peak, fabs(u2));
    }
  }
  fclose(file);
  require(row == ROWS, "the reference has too few rows");
}

static double error_of_run(void)
{
  double most = 0;
  for (int row = 0; row < ROWS; row++) {
    const double apart = fabs(deflection[row] - reference[row]);
    most = apart <= most ? most : apart; /* what is not a number counts */
  }
  return most / peak;
}

/* ---- flexbeam */

static fb_body body;
static fb_body_work body_work;
static int tip; /* node */

static void build(int modes, unsigned effects)
{
  static fb_shape shape;
  const boom b = {BOOM_LENGTH, BOOM_MASS, BOOM_EI, BOOM_EA, .planes = 1, .modes = modes};
  fb_body_desc desc;
  memset(&desc, 0, sizeof desc);
  desc.effects = effects;
  desc.base = FB_BASE_PRESCRIBED;
  fbb_check(boom_shape(&shape, &tip, &b), "shape integrals");
  fbb_check(fb_body_init(&body, &body_work, &shape, &desc), "body");
}

/* 1, or 0 when the step is refused */
static int run_flexbeam(double *ns, fb_integrator integrator, int steps)
{
  static fb_rk4_work rk4;
  static fb_exponential scheme;
  static fb_exponential_work exponential;
  const double dt = SPIN_UP_END / ROWS / steps;
  fb_input input[3];
  fb_state state;
  fb_status status = FB_OK;
  double start;
  memset(input, 0, sizeof input);
  fbb_check(fb_state_init(&body, &state), "state");
  if (integrator == FB_INTEGRATOR_EXPONENTIAL &&
      fb_exponential_init(&scheme, &body_work, &body, (fb_real)dt) != FB_OK) {
    return 0;
  }
  start = clock_own_ns();
  spin_up_drive(&input[0], 0.0);
  for (int k = 1; k <= ROWS * steps && status == FB_OK; k++) {
    spin_up_drive(&input[1], (k - 0.5) * dt);
    spin_up_drive(&input[2], k * dt);
    status = integrator == FB_INTEGRATOR_RK4
                 ? fb_rk4_step(&body, &state, &rk4, &input[0], &input[1], &input[2], (fb_real)dt)
                 : fb_exponential_step(&body, &scheme, &state, &exponential, &input[0], &input[1], &input[2]);
    input[0] = input[2];
    if (k % steps == 0 && status == FB_OK) {
      fb_motion motion;
      fb_node_motion node;
      fbb_check(fb_body_motion_eval(&body, &motion, &state, &input[0]), "motion");
      fbb_check(fb_body_node_motion_eval(&body, &node, &state, &motion, tip), "tip");
      deflection[k / steps - 1] = (double)node.displacement[1];
    }
  }
  *ns = clock_own_ns() - start;
  return status == FB_OK;
}

/* ---- MuJoCo */

static mjModel *model;
static mjData *data;
static int links;

/* Called at every stage of a step. */
static void drive_hub(const mjModel *m, mjData *d)
{
  (void)m;
  d->qfrc_applied[0] = INERTIA * spin_up_acceleration(d->time);
}

/* Of steps beyond stability, which are tried; MuJoCo writes them to a file otherwise. */
static void take_warning(const char *text)
{
  (void)text;
}

static void build_chain(int n, const char *path)
{
  static char text[TEXT];
  char error[256] = "";
  const double h = BOOM_LENGTH / n;
  int used = 0;
  FILE *file;
  used += snprintf(text + used, TEXT - (size_t)used,
                   "<mujoco><compiler angle=\"radian\"/><option gravity=\"0 0 0\"/><worldbody><body name=\"hub\">"
                   "<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>"
                   "<joint type=\"hinge\" axis=\"0 0 1\" armature=\"%.17g\"/>\n",
                   INERTIA - 1);
  for (int i = 0; i < n; i++) {
    const double length = i + 1 < n ? h : 0.5 * h, mass = BOOM_LINE * length, I = mass * length * length / 12;
    used += snprintf(
        text + used, TEXT - (size_t)used,
        "<body pos=\"%.17g 0 0\"><inertial pos=\"%.17g 0 0\" mass=\"%.17g\" diaginertia=\"%.17g %.17g %.17g\"/>"
        "<joint type=\"hinge\" axis=\"0 0 1\" stiffness=\"%.17g\"/>\n",
        i == 0 ? 0.5 * h : h, 0.5 * length, mass, 0.01 * I, I, I, BOOM_EI / h);
    require(used < TEXT - 1024, "too many links");
  }
  for (int i = 0; i <= n; i++) {
    used += snprintf(text + used, TEXT - (size_t)used, "</body>");
  }
  (void)snprintf(text + used, TEXT - (size_t)used, "</worldbody></mujoco>\n");
  file = fopen(path, "w");
  require(file != NULL && fputs(text, file) >= 0, "cannot write MuJoCo's model");
  require(fclose(file) == 0, "cannot write MuJoCo's model");
  model = mj_loadXML(path, NULL, error, sizeof error);
  require(model != NULL, error);
  model->opt.disableflags |= mjDSBL_CONSTRAINT | mjDSBL_CONTACT | mjDSBL_GRAVITY;
  data = mj_makeData(model);
  require(data != NULL, "no memory");
  links = n;
}

static double chain_deflection(void)
{
  const double h = BOOM_LENGTH / links;
  double turn = 0, y = 0;
  for (int i = 0; i < links; i++) {
    turn += data->qpos[1 + i];
    y += (i + 1 < links ? h : 0.5 * h) * sin(turn);
  }
  return y;
}

static int run_chain(double *ns, int integrator, int steps)
{
  const double start = clock_own_ns();
  int sound = 1;
  model->opt.integrator = integrator;
  model->opt.timestep = SPIN_UP_END / ROWS / steps;
  mj_resetData(model, data);
  for (int k = 1; k <= ROWS * steps && sound; k++) {
    mj_step(model, data);
    if (k % steps == 0) {
      deflection[k / steps - 1] = chain_deflection();
      sound = fabs(deflection[k / steps - 1]) < BOOM_LENGTH && data->warning[mjWARN_BADQACC].number == 0;
    }
  }
  *ns = clock_own_ns() - start;
  return sound;
}

/* ---- ladders */

typedef int run(double *ns, int integrator, int steps);

static int run_body(double *ns, int integrator, int steps)
{
  return run_flexbeam(ns, (fb_integrator)integrator, steps);
}

/* Longest steps first, each two thirds of the one before. */
static void climb(int code, const char *method, run *go, int integrator)
{
  double before = HUGE_VAL, ns = 0;
  for (int steps = 2, stale = 0; stale < 2 && ns < SLOW && steps < 1000000; steps += steps / 2) {
    rung *const r = &rungs[n_rung];
    double total;
    if (!go(&ns, integrator, steps) || !(error_of_run() < FAR)) {
      continue; /* beyond stability */
    }
    r->code = code;
    (void)snprintf(r->method, sizeof r->method, "%s", method);
    r->step = SPIN_UP_END / ROWS / steps;
    r->error = error_of_run();
    r->time = 1e-3 * ns / SPIN_UP_END;
    total = ns;
    for (int k = 1; k < RUNS && total < TURNS; k++) {
      require(go(&ns, integrator, steps), "a run fails the second time");
      r->time = fmin(r->time, 1e-3 * ns / SPIN_UP_END);
      total += ns;
    }
    stale = r->error > 0.98 * before ? stale + 1 : 0;
    before = fmin(before, r->error);
    n_rung += n_rung < RUNGS - 1;
  }
}

static void climb_flexbeam(void)
{
  static const struct {
    const char *name;
    unsigned effects;
  } kinds[] = {{"full", FB_EFFECTS_FULL}, {"large", FB_EFFECTS_LARGE}};
  static const struct {
    const char *name;
    fb_integrator integrator;
  } ways[] = {{"rk4", FB_INTEGRATOR_RK4}, {"exponential", FB_INTEGRATOR_EXPONENTIAL}};
  for (int kind = 0; kind < 2; kind++) {
    for (int modes = 1; modes <= MODES_MOST; modes++) {
      build(modes, kinds[kind].effects);
      for (int way = 0; way < 2; way++) {
        char method[48];
        (void)snprintf(method, sizeof method, "%d modes %s %s", modes, kinds[kind].name, ways[way].name);
        climb(FLEXBEAM, method, run_body, (int)ways[way].integrator);
      }
    }
  }
}

static void climb_mujoco(const char *path)
{
  static const int counts[] = {4, 6, 8, 12, 16, 24, 32, 42};
  static const struct {
    const char *name;
    int integrator;
  } ways[] = {{"RK4", mjINT_RK4}, {"Euler", mjINT_EULER}, {"implicit", mjINT_IMPLICIT}};
  mjcb_control = drive_hub;
  mju_user_warning = take_warning;
  for (int count = 0; count < (int)(sizeof counts / sizeof counts[0]); count++) {
    build_chain(counts[count], path);
    for (int way = 0; way < (int)(sizeof ways / sizeof ways[0]); way++) {
      char method[48];
      (void)snprintf(method, sizeof method, "%d links %s", counts[count], ways[way].name);
      fprintf(stderr, "MuJoCo, %s\n", method);
      climb(MUJOCO, method, run_chain, ways[way].integrator);
    }
    mj_deleteData(data);
    mj_deleteModel(model);
  }
}

/* ---- results */

/* The cheapest of a code that is as good as that; NULL: none. */
static const rung *cheapest(int code, double error)
{
  const rung *best = NULL;
  for (int k = 0; k < n_rung; k++) {
    if (rungs[k].code == code && rungs[k].error <= error && (!best || rungs[k].time < best->time)) {
      best = &rungs[k];
    }
  }
  return best;
}

static void print_results(void)
{
  static const double errors[TOLERANCES] = {0.1, 0.01, 0.003, 0.001};
  printf("what,code,method,step,error,time,ratio\n");
  for (int k = 0; k < n_rung; k++) {
    printf("rung,%s,%s,%.4g,%.3e,%.4g,\n", code_name[rungs[k].code], rungs[k].method, rungs[k].step, rungs[k].error,
           rungs[k].time);
  }
  for (int k = 0; k < TOLERANCES; k++) {
    const rung *const ours = cheapest(FLEXBEAM, errors[k]);
    for (int code = 0; code < CODES; code++) {
      const rung *const r = cheapest(code, errors[k]);
      printf("equal %g,%s,", errors[k], code_name[code]);
      if (r && ours) {
        printf("%s,%.4g,%.3e,%.4g,%.4g\n", r->method, r->step, r->error, r->time, r->time / ours->time);
      } else {
        printf("none,,,,\n");
      }
    }
  }
}

int main(int argc, char **argv)
{
  output_begin("bench_peers_mujoco");
  require(argc == 3, "usage: bench_peers_mujoco REFERENCE MODEL");
  (void)fbb_begin();
  printf("# MuJoCo %s; us of processor time per simulated second, the least of up to %d runs\n", mj_versionString(),
         RUNS);
  read_reference(argv[1]);
  climb_flexbeam();
  climb_mujoco(argv[2]);
  print_results();
  return 0;
}
