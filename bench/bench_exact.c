/* bench_exact - time of the geometrically exact beam, CSV on stdout: a Newton iteration of a steady state, and a time
   step, by elements; beside them the same with one dense LU: of all 42 fields an element has in [L] (displacement and
   rotation, velocity, strain, momentum, stress, loads at both ends), and of the 12 that are left when the others are
   eliminated within the element. The ways take turns, so that they share what disturbs the machine, and are checked to
   give the same corrections.
   The mark is OpenFAST's BeamDyn on another machine (Xeon core of 2.1 GHz): one element of order 5 (36 unknowns) and
   the NREL blade. Each step starts from one of 16 states in turn; it is timed by itself, and the time of an empty
   measurement is taken off. */
#define _POSIX_C_SOURCE 200112L /* clock_gettime, uname */
#define FB_MAX_EXACT 80
#define FLEXBEAM_STATIC
#include "report.h"
#include "../examples/common/output.h"
#include <math.h>

#define STATES 16
#define SAMPLES 2000
#define BUDGET 0.5    /* [s] a case takes at most */
#define FIELDS_MAX 10 /* elements of the dense ways */
#define DENSE_MAX 20
#define UNKNOWNS (42 * FIELDS_MAX + 6)

enum { CHAIN, DENSE, FIELDS, WAYS };
static const char *const way_name[WAYS] = {"chain", "dense 12", "dense 42"};

static fb_exact_desc desc;
static fb_exact beam;
static fb_exact_state start[STATES], state;
static fb_exact_work work;
static fb_exact_input input;
static double sample[WAYS][SAMPLES];
static double overhead; /* [us] of an empty measurement */

/* A boom of 10 m that spins, bent by half its length; then let go, and states on its way. */
static void build(int n)
{
  static const double stiffness[6] = {1e5, 4e4, 4e4, 80, 100, 150}, inertia[6] = {1, 1, 1, 1e-3, 5e-4, 5e-4};
  memset(&desc, 0, sizeof desc);
  memset(&input, 0, sizeof input);
  desc.length = 10;
  desc.n_element = n;
  desc.n_station = 1;
  desc.gravity[2] = FB_R(-1.0);
  for (int i = 0; i < 6; i++) {
    desc.station[0].stiffness[7 * i] = (fb_real)stiffness[i];
    desc.station[0].inertia[7 * i] = (fb_real)inertia[i];
  }
  input.n_load = 1;
  input.load[0].node = n;
  input.load[0].force[1] = 3;
  input.w[2] = FB_R(0.2);
  fbb_check(fb_exact_init(&beam, &desc), "beam");
  fbb_check(fb_exact_state_init(&beam, &state, &work, &input), "state");
  fbb_check(fb_exact_trim(&beam, &state, &work, &input), "steady state");
  input.n_load = 0;
  for (int k = 0; k < STATES; k++) {
    for (int i = 0; i < 20; i++) {
      fbb_check(fb_exact_step(&beam, &state, &work, &input, FB_R(0.002)), "step");
    }
    start[k] = state;
  }
}

/* ---- the dense ways: unknowns d0, s0, d1, s1, .. dn, and behind them the other fields of each element */

static fb_real matrix[UNKNOWNS * UNKNOWNS], right[UNKNOWNS], solution[UNKNOWNS], row_scale[UNKNOWNS];
static int order[UNKNOWNS];

static int unknowns(int way)
{
  return (way == FIELDS ? 42 : 12) * beam.n + 6;
}

static void put(int n, int row, int column, const fb_real block[36], fb_real sign)
{
  for (int i = 0; i < 6; i++) {
    for (int j = 0; j < 6; j++) {
      matrix[(row + i) * n + column + j] += sign * block[6 * i + j];
    }
  }
}

static void put_one(int n, int row, int column, fb_real value)
{
  for (int i = 0; i < 6; i++) {
    matrix[(row + i) * n + column + i] += value;
  }
}

/* Loads at the ends, strain, mean velocity and momentum of element k as unknowns of their own: F1, F2, e, v, p. */
static void put_fields(int n, int k)
{
  const fbi_exact_jacobian *const j = &work.jacobian;
  const int a = 12 * k, s = a + 6, b = a + 12, F1 = 12 * beam.n + 6 + 30 * k, F2 = F1 + 6, e = F1 + 12, v = F1 + 18;
  for (int row = F1; row < F1 + 30; row += 6) {
    put_one(n, row, row, 1);
  }
  put(n, F1, a, j->F1d1, -1);
  put(n, F1, b, j->F1d2, -1);
  put(n, F1, s, j->F1s, -1);
  put(n, F2, a, j->F2d1, -1);
  put(n, F2, b, j->F2d2, -1);
  put(n, F2, s, j->F2s, -1);
  put(n, e, s, beam.C + 36 * k, -1);
  put_one(n, v, a, FB_R(-0.5));
  put_one(n, v, b, FB_R(-0.5));
  put(n, v + 6, v, beam.M + 36 * k, -1);
  put_one(n, a, F1, -1);
  put_one(n, b, F2, 1);
}

static fb_status dense_factor(int way)
{
  const int n = unknowns(way);
  fbi_exact_jacobian *const j = &work.jacobian;
  memset(matrix, 0, sizeof *matrix * (size_t)(n * n));
  for (int k = 0; k < beam.n; k++) {
    const int a = 12 * k, e = a + 6, b = a + 12;
    fbi_exact_cell_eval(&work.cell, &work, &beam, k, 1);
    fbi_exact_cell_jacobian(j, &work, &beam, k);
    put(n, e, a, j->D1, -1);
    put(n, e, b, j->D2, -1);
    put(n, e, e, j->E, 1);
    if (way == FIELDS) {
      put_fields(n, k);
    } else {
      put(n, a, a, j->F1d1, -1);
      put(n, a, b, j->F1d2, -1);
      put(n, a, e, j->F1s, -1);
      put(n, b, a, j->F2d1, 1);
      put(n, b, b, j->F2d2, 1);
      put(n, b, e, j->F2s, 1);
    }
  }
  for (int k = 0; k <= beam.n; k++) {
    fb_real K[36] = {0};
    fbi_exact_node_jacobian(K, &work, &beam, k);
    put(n, 12 * k, 12 * k, K, 1);
    if (beam.held[k]) { /* clamped: all of it */
      memset(matrix + 12 * k * n, 0, sizeof *matrix * (size_t)(6 * n));
      put_one(n, 12 * k, 12 * k, 1);
    }
  }
  return fb_lu_factor(matrix, order, row_scale, n);
}

static void dense_solve(int way)
{
  const int n = unknowns(way);
  memset(right, 0, sizeof right);
  for (int k = 0; k <= beam.n; k++) {
    for (int i = 0; i < 6; i++) {
      right[12 * k + i] = beam.held[k] ? work.want[6 * k + i] : -work.B[6 * k + i];
      if (k < beam.n) {
        right[12 * k + 6 + i] = -work.c[6 * k + i];
      }
    }
  }
  fb_lu_solve(solution, matrix, order, right, n);
  for (int k = 0; k <= beam.n; k++) {
    fbi_vec6_copy(work.dd + 6 * k, solution + 12 * k);
    if (k < beam.n) {
      fbi_vec6_copy(work.ds + 6 * k, solution + 12 * k + 6);
    }
  }
}

static fb_status factor(int way)
{
  return way == CHAIN ? fbi_exact_factor(&work, &beam) : dense_factor(way);
}

static void solve(int way)
{
  if (way == CHAIN) {
    fbi_exact_solve(&work, &beam);
  } else {
    dense_solve(way);
  }
}

/* ---- what is timed */

/* One Newton iteration of the steady state from a start. */
static void iteration(int way, int at)
{
  const fbi_exact_motion steady = {0, 1, 0, 0, 1, 0, 0, 0};
  work.motion = steady;
  fbi_exact_pose_enter(&work, &start[at], &beam);
  fbi_exact_input_set(&work, &beam, start[at].base_quat, &input, 1, 0);
  fbi_exact_middle(&work, &beam, 0, 1);
  fbb_check(factor(way), "factors");
  solve(way);
}

/* A time step of 2 ms; the dense ones are fb_exact_step with the other solver. */
static void step(int way, int at)
{
  const fb_real dt = FB_R(0.002), h = dt / beam.time;
  state = start[at];
  if (way == CHAIN) {
    fbb_check(fb_exact_step(&beam, &state, &work, &input, dt), "step");
    return;
  }
  fbi_exact_begin(&work, &beam, &state, &input, h);
  fbi_exact_middle(&work, &beam, h, 1);
  fbb_check(factor(way), "factors");
  for (int it = 0; it < beam.iterations; it++) {
    solve(way);
    fbi_exact_correct(&work, &beam, FB_R(1.0));
    fbi_exact_middle(&work, &beam, h, 1);
  }
  fbi_exact_end(&state, &work, &beam, h);
}

/* All ways give the same. */
static void compare(void)
{
  static fb_real dd[6 * (FB_MAX_EXACT + 1)];
  static fb_exact_state other;
  for (int way = DENSE; way < WAYS; way++) {
    double most = 0, size = 0;
    iteration(CHAIN, 3);
    fbi_copy(dd, work.dd, 6 * (beam.n + 1));
    iteration(way, 3);
    for (int i = 0; i < 6 * (beam.n + 1); i++) {
      most = fmax(most, fabs((double)(dd[i] - work.dd[i])));
      size = fmax(size, fabs((double)dd[i]));
    }
    step(CHAIN, 3);
    other = state;
    step(way, 3);
    for (int i = 0; i < 6 * beam.n; i++) {
      most = fmax(most, fabs((double)(other.momentum[i] - state.momentum[i])));
    }
    printf("# chain and %s differ by %.1e\n", way_name[way], most / size);
    if (!(most < (FB_SINGLE ? 1e-2 : 1e-8) * size)) {
      fprintf(stderr, "bench_exact: chain and %s differ\n", way_name[way]);
      exit(1);
    }
  }
}

static void measure(clock_timing out[WAYS], void (*run)(int way, int at), int ways)
{
  const double until = clock_ns() + 1e9 * BUDGET;
  int n = 0;
  while (n < SAMPLES && (n < 20 || clock_ns() < until)) {
    for (int way = 0; way < ways; way++) {
      double begin;
      run(way, (n + 5) * 7 % STATES); /* the dense matrices have pushed everything else out of the cache */
      begin = clock_ns();
      run(way, n * 7 % STATES);
      sample[way][n] = 1e-3 * (clock_ns() - begin) - overhead;
    }
    n++;
  }
  for (int way = 0; way < ways; way++) {
    out[way] = clock_timing_of(sample[way], n);
  }
}

static void rows(const char *what, void (*run)(int way, int at))
{
  static const int size[] = {10, 20, 40, 80};
  double first = 0;
  for (int k = 0; k < 4; k++) {
    const int ways = size[k] <= FIELDS_MAX ? 3 : size[k] <= DENSE_MAX ? 2 : 1;
    clock_timing t[WAYS]; /* [us] */
    build(size[k]);
    measure(t, run, ways);
    first = k == 0 ? t[0].lowest : first;
    for (int way = 0; way < ways; way++) {
      printf("%s,%d,%s,%.2f,%.2f,%.2f,%.2f", what, size[k], way_name[way], t[way].lowest, t[way].median, t[way].p99,
             t[way].highest);
      if (way) {
        printf(",,%.1f\n", t[way].lowest / t[0].lowest);
      } else {
        printf(",%.3f,\n", t[0].lowest / first * 10 / size[k]);
      }
    }
  }
}

/* A beam that has come to rest, all values on their way through the subnormals. */
static void decayed(void)
{
  clock_timing t[WAYS];
  build(10);
  memset(&input, 0, sizeof input);
  for (int k = 0; k < STATES; k++) {
    fbb_check(fb_exact_state_init(&beam, &start[k], &work, &input), "state");
    for (int i = 0; i < 6 * beam.n; i++) {
      start[k].momentum[i] = start[k].strain[i] = (fb_real)((i + k + 1) * (FB_SINGLE ? 1e-41 : 1e-310));
    }
  }
  beam.gravity[2] = 0;
  measure(t, step, 1);
  printf("step at rest,10,chain,%.2f,%.2f,%.2f,%.2f,,\n", t[0].lowest, t[0].median, t[0].p99, t[0].highest);
}

int main(void)
{
  output_begin("bench_exact");
  overhead = 1e-3 * fbb_begin();
  printf("# us (%.3f us of the clock taken off), up to %d samples, %d states in turn\n", overhead, SAMPLES, STATES);
  printf("# work of fb_exact_work %.1f kB, model %.1f kB, state %.1f kB for 80 elements: linear in them\n",
         (double)sizeof work / 1024, (double)sizeof beam / 1024, (double)sizeof state / 1024);
  printf("# proportional: least time per element to that of 10; dense/chain: of the least\n");
  printf("# mark, another machine: BeamDyn (OpenFAST) 157 us a step with 36 unknowns, 742 us for the NREL blade\n");
  build(10);
  compare();
  printf("what,elements,solver,min,median,p99,max,proportional,dense/chain\n");
  rows("iteration", iteration);
  rows("step", step);
  decayed();
  return 0;
}
