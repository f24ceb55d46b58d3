/* E10.9, E10.10, E10.23, E10.26: the Jacobian of the exact beam against central differences of its residual, and the
   elimination along chain and branches against one dense LU: random sections (full 6x6), curvature, poses, stresses and velocities, in every
   combination of what can act. Compatibility by the poses is a series, cut at theta^4/720: left out here, Newton's
   convergence shows it. Double precision. */
#define FB_MAX_EXACT 9
#define FLEXBEAM_STATIC
#include "flexbeam.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
  GRAVITY = 1,
  DEAD_LINE = 2,
  FOLLOWER_LINE = 4,
  LUMPS = 8,
  SUPPORTS = 16,
  LOADS = 32,
  JOINT = 64,
  BRANCH = 128,
  COMBINATIONS = 256
};
enum { REST, SPIN, MARCH, LINEARIZED, WAYS };
#define UNKNOWNS (12 * FB_MAX_EXACT + 6)

static fb_exact_desc desc;
static fb_exact beam;
static fb_exact_state state;
static fb_exact_work work, moved;
static fb_exact_input input;
static double numeric[UNKNOWNS * UNKNOWNS], analytic[UNKNOWNS * UNKNOWNS], right[UNKNOWNS], solution[UNKNOWNS];
static double row_scale[UNKNOWNS];
static int order[UNKNOWNS];
static const double step = 0.37;

/* Repeatable, in (-1, 1). */
static double random_number(void)
{
  static unsigned seed = 1u;
  seed = seed * 1664525u + 1013904223u;
  return (double)(seed >> 8) / 8388608.0 - 1.0;
}

static void fill(double *x, int n, double size)
{
  for (int i = 0; i < n; i++) {
    x[i] = size * random_number();
  }
}

static void require(fb_status status, const char *what)
{
  if (status != FB_OK) {
    printf("%s: %s\n", what, fb_status_string(status));
    exit(1);
  }
}

static void build(int what, int n)
{
  const fb_section mass = {
      .mass = 1.1, .EA = 1, .GJ = 1, .EI_y = 1, .EI_z = 1, .i_y = 0.02, .i_z = 0.05, .mass_y = 0.1, .mass_z = -0.13};
  double A[36];
  memset(&desc, 0, sizeof desc);
  desc.length = 1.3;
  desc.n_element = n;
  desc.n_station = 1;
  require(fb_exact_station_init(&desc.station[0], &mass), "section");
  fill(A, 36, 1);
  for (int i = 0; i < 36; i++) { /* positive definite */
    desc.station[0].stiffness[i] = (i % 7 ? 0 : 2) + fbi_vec6_dot(A + i / 6 * 6, A + i % 6 * 6);
  }
  fill(desc.station[0].curvature, 3, 1);
  fill(desc.attitude, 4, 1);
  fill(desc.position, 3, 1);
  if (what & GRAVITY) {
    fill(desc.gravity, 3, 1);
  }
  for (int l = 0; l < 2 && what & LUMPS; l++) {
    desc.n_lump = 2;
    desc.lump[l].node = l * n;
    desc.lump[l].mass = 0.5;
    fill(desc.lump[l].center, 3, 1);
    desc.lump[l].inertia[0] = desc.lump[l].inertia[1] = desc.lump[l].inertia[2] = 0.3;
    desc.lump[l].inertia[4] = 0.05;
  }
  if (what & SUPPORTS) {
    desc.root = FB_HOLD_X | FB_HOLD_Z | FB_HOLD_RY;
    desc.tip = FB_HOLD_Y | FB_HOLD_RX;
    desc.n_support = 1;
    desc.support[0].node = 1;
    desc.support[0].held = FB_HOLD_X | FB_HOLD_Z | FB_HOLD_RZ;
  }
  if (what & JOINT) { /* its outboard node is no other's */
    desc.n_joint = 1;
    desc.n_element++;
    desc.joint[0].element = 1;
    fill(desc.joint[0].axis, 3, 1);
    desc.joint[0].driven = n == 2;
    desc.joint[0].angle = 0.4;
    desc.joint[0].rest = -0.6;
    desc.joint[0].stiffness = 1.7;
    desc.joint[0].damping = 0.9;
    if (desc.n_lump) {
      desc.lump[1].node = n + 1;
    }
  }
  for (int b = 0; b < 2 && what & BRANCH; b++) { /* the second on the first, at an angle */
    desc.n_branch = 2;
    desc.branch[b].node = b ? desc.n_element + 1 : what % 3;
    desc.branch[b].n_element = 2;
    desc.branch[b].length = 0.7 + b;
    fill(desc.branch[b].attitude, b ? 4 : 0, 1);
  }
  desc.dissipation = 0.3;
  for (int i = 0; i < 6; i++) { /* 0, equal or not */
    desc.damping[i] = what % 3 == 0 ? 0 : what % 3 == 1 ? 0.02 : 0.01 * (1 + i);
  }
  require(fb_exact_init(&beam, &desc), "beam");
}

static void load(int what, int way)
{
  memset(&input, 0, sizeof input);
  for (int k = 0; k < beam.n && what & (DEAD_LINE | FOLLOWER_LINE); k++) {
    input.line[k].axes = what & DEAD_LINE ? (k % 2 ? FB_AXES_INERTIAL : FB_AXES_BODY) : FB_AXES_NODE;
    fill(input.line[k].force, 3, 1);
    fill(input.line[k].torque, 3, 1);
  }
  for (int l = 0; l < 3 && what & LOADS; l++) {
    input.n_load = 3;
    input.load[l].node = l % (beam.n + 1);
    input.load[l].axes = (fb_axes)l;
    fill(input.load[l].force, 3, 1);
    fill(input.load[l].torque, 3, 1);
  }
  if (way != REST) {
    fill(input.v, 3, 1);
    fill(input.w, 3, 1);
  }
}

/* A state in which the strains fit the poses, so that the residual of the compatibility vanishes. The turn of half a
   step is taken to first order: where something acts in axes that do not turn along, what marches turns slowly. */
static void scatter(int what, int way)
{
  const double turning = what & (GRAVITY | DEAD_LINE | SUPPORTS | LOADS) ? 1e-6 : 1;
  const double rate = 2 / ((1 + beam.beta) * step);
  const fbi_exact_motion motion = {way == MARCH,
                                   way != REST,
                                   0,
                                   0,
                                   way == MARCH ? step / 2 : 1,
                                   way == MARCH        ? rate
                                   : way == LINEARIZED ? 1.37
                                                       : 0,
                                   way != REST && fbi_exact_damped(&beam),
                                   0};
  memset(&work, 0, sizeof work);
  require(fb_exact_state_init(&beam, &state, &work, &input), "state");
  fill(state.base_quat, 4, 1);
  require(fb_quat_normalize(state.base_quat), "attitude");
  work.motion = motion;
  fbi_exact_input_set(&work, &beam, state.base_quat, &input, 1, way == MARCH ? step : 0);
  fill(work.s, 6 * beam.n, 0.7);
  fill(work.strain, 6 * beam.n, 0.1);
  fill(work.momentum, 6 * beam.n, 1);
  fill(work.velocity, 6 * (beam.n + 1), 1);
  fbi_exact_damp(&work, &beam);
  for (int k = 0; k < beam.n; k++) {
    fbi_mat66_mul_vec6(state.strain + 6 * k, beam.C + 36 * k, work.s + 6 * k);
  }
  memcpy(state.offset, work.offset, sizeof state.offset);
  fill(state.angle, beam.n_joint, 2);
  memcpy(work.angle, state.angle, sizeof work.angle);
  fill(work.angle_base, beam.n_joint, 1);
  fbi_exact_poses(work.r, work.quat, &beam, &state);
  memcpy(state.quat, work.quat, sizeof state.quat);
  fbi_exact_middles_begin(&work, &beam, &state);
  for (int i = 0; i < 6 * (beam.n + 1) && way == MARCH; i++) {
    work.V[i] = random_number() * (i % 6 < 3 ? 1 : turning);
  }
  fbi_exact_nodes_eval(&work, &beam);
  for (int k = 0; k < beam.n && way == LINEARIZED; k++) {
    fbi_exact_cell_eval(&work.cell, &work, &beam, k, 1);
    fbi_vec6_copy(work.momentum + 6 * k, work.cell.P);
  }
  if (way == LINEARIZED) {
    memcpy(work.velocity, work.V, sizeof work.velocity);
    fbi_exact_node_momenta(&work, &beam);
  }
}

/* Residual with one unknown changed: stresses of the elements first, then the nodes. */
static void residual(double *out, int unknown, double change)
{
  const int stress = 6 * beam.n, node = (unknown - stress) / 6;
  moved = work;
  if (unknown < stress) {
    moved.s[unknown] += change;
  } else if (moved.motion.march) {
    moved.V[unknown - stress] += change;
    fbi_exact_nodes_eval(&moved, &beam);
  } else {
    double x[6] = {0};
    x[(unknown - stress) % 6] = change;
    fbi_pose_add(moved.r + 3 * node, moved.quat + 4 * node, x);
    fbi_exact_nodes_eval(&moved, &beam);
    moved.V[unknown - stress] += moved.motion.shift * change;
    for (int l = 0; l < beam.n_joint; l++) { /* a damper, by the rate that goes with the change */
      const int k = beam.joint[l].element, outboard = node == k + 1, i = (unknown - stress) % 6 - 3;
      if (i >= 0 && (outboard || node == beam.inboard[k])) {
        moved.motor[l] -=
            beam.joint[l].damping * moved.motion.shift * beam.joint[l].axis[i] * (outboard ? x[3 + i] : -x[3 + i]);
      }
    }
  }
  fbi_exact_residual(&moved, &beam);
  memcpy(out, moved.c, sizeof *out * (size_t)stress);
  for (int j = 0; j <= beam.n; j++) {
    if (fbi_exact_turned(beam.held[j])) {
      fbi_exact_rows_turn(moved.B + 6 * j, moved.R + 9 * j, 1);
    }
  }
  memcpy(out + stress, moved.B, sizeof *out * (size_t)(stress + 6));
}

static void put(int row, int column, const double block[36], double sign)
{
  const int n = 12 * beam.n + 6;
  for (int i = 0; i < 36; i++) {
    analytic[(row + i / 6) * n + column + i % 6] += sign * block[i];
  }
}

/* The Jacobian from its blocks; rows of nodes that are held in part are turned. */
static void assemble(void)
{
  const int n = 12 * beam.n + 6, nodes = 6 * beam.n;
  const fbi_exact_jacobian *const j = &work.jacobian;
  memset(analytic, 0, sizeof analytic);
  fbi_exact_residual(&work, &beam);
  for (int k = 0; k < beam.n; k++) {
    const int s = 6 * k, a = nodes + 6 * beam.inboard[k], b = nodes + 6 * k + 6;
    fbi_exact_cell_eval(&work.cell, &work, &beam, k, 1);
    if (beam.jointed[k]) {
      fbi_exact_joint_jacobian(&work.jacobian, &work, &beam, k);
    } else {
      fbi_exact_cell_jacobian(&work.jacobian, &work, &beam, k);
    }
    put(s, s, j->E, 1);
    put(s, a, j->D1, -1);
    put(s, b, j->D2, -1);
    put(a, s, j->F1s, -1);
    put(a, a, j->F1d1, -1);
    put(a, b, j->F1d2, -1);
    put(b, s, j->F2s, 1);
    put(b, a, j->F2d1, 1);
    put(b, b, j->F2d2, 1);
  }
  for (int k = 0; k <= beam.n; k++) {
    double K[36] = {0};
    const int row = nodes + 6 * k;
    fbi_exact_node_jacobian(K, &work, &beam, k);
    put(row, row, K, 1);
    if (fbi_exact_turned(beam.held[k])) {
      fbi_add_skew(analytic + row * n + row + 3, n, -work.motion.pose, work.B + 6 * k);
      fbi_exact_rows_turn(analytic + row * n, work.R + 9 * k, n);
    }
  }
}

/* Steady, the loads of an element are derived along its compatibility alone: eliminates the stresses of the elements that
   are no joints from the balance. */
static void condense(double *A)
{
  const int n = 12 * beam.n + 6, stress = 6 * beam.n;
  for (int k = 0; k < beam.n; k++) {
    double E[36], scale[6], x[6], factor[6];
    int perm[6];
    if (beam.jointed[k]) {
      continue;
    }
    for (int i = 0; i < 36; i++) { /* transposed */
      E[i] = A[(6 * k + i % 6) * n + 6 * k + i / 6];
    }
    require(fb_lu_factor(E, perm, scale, 6), "compliance");
    for (int r = stress; r < n; r++) {
      memcpy(x, A + r * n + 6 * k, sizeof x);
      fb_lu_solve(factor, E, perm, x, 6);
      for (int i = 0; i < 6; i++) {
        fbi_row_sub(A + r * n, factor[i], A + (6 * k + i) * n, n);
      }
    }
  }
}

/* Largest difference from central differences, of the largest element. */
static double compare_differences(void)
{
  static double condensed[UNKNOWNS * UNKNOWNS];
  const int n = 12 * beam.n + 6;
  const double h = 1e-6;
  double forward[UNKNOWNS], back[UNKNOWNS], most = 0, size = 1;
  for (int c = 0; c < n; c++) {
    residual(forward, c, h);
    residual(back, c, -h);
    for (int r = 0; r < n; r++) {
      numeric[r * n + c] = (forward[r] - back[r]) / (2 * h);
    }
  }
  memcpy(condensed, analytic, sizeof condensed);
  for (int i = 0; i < n * n; i++) {
    size = fmax(size, fabs(numeric[i]));
  }
  if (!work.motion.march) {
    condense(numeric);
    condense(condensed);
  }
  for (int r = 0; r < n; r++) {
    for (int c = 0; c < n; c++) {
      most = fmax(most, fabs(numeric[r * n + c] - condensed[r * n + c]));
    }
  }
  return most / size;
}

/* Largest difference of the corrections by the chain from those of a dense LU, of the largest. */
static double compare_dense(void)
{
  const int n = 12 * beam.n + 6, stress = 6 * beam.n;
  double most = 0, size = 1;
  fbi_exact_want(&work, &beam, step);
  require(fbi_exact_factor(&work, &beam), "chain");
  fbi_exact_solve(&work, &beam);
  for (int i = 0; i < stress; i++) {
    right[i] = -work.c[i];
  }
  for (int k = 0; k <= beam.n; k++) {
    double b[6];
    for (int i = 0; i < 6; i++) {
      b[i] = -work.B[6 * k + i];
    }
    fbi_exact_hold_rhs(b, &work, &beam, k);
    for (int i = 0; i < 6; i++) {
      const int row = stress + 6 * k + i, turned = i < 3 && fbi_exact_turned(beam.held[k]);
      right[row] = b[i];
      if (beam.held[k] >> i & 1) {
        memset(analytic + row * n, 0, sizeof *analytic * (size_t)n);
        for (int j = 0; j < 3; j++) {
          analytic[row * n + row - i + i / 3 * 3 + j] = turned ? work.R[9 * k + 3 * i + j] : i % 3 == j;
        }
      }
    }
  }
  require(fb_lu_factor(analytic, order, row_scale, n), "dense");
  fb_lu_solve(solution, analytic, order, right, n);
  for (int i = 0; i < n; i++) {
    size = fmax(size, fabs(solution[i]));
    most = fmax(most, fabs(solution[i] - (i < stress ? work.ds[i] : work.dd[i - stress])));
  }
  return most / size;
}

/* Negative eigenvalues of symmetric matrices whose inertia is known, of n rows: B D B^T has as many as D; (0 B; B^T C), which
   wants pivots of 2x2, half of n. */
static void require_negatives(void)
{
  for (int run = 0; run < 2000; run++) {
    const int pairs = run % 2, n = pairs ? 2 + 2 * (run % 6) : 1 + run % 12, half = n / 2;
    fb_real A[144], B[144], D[12];
    int expected = pairs ? half : 0, found;
    for (int i = 0; i < n * n; i++) {
      B[i] = random_number() + (i % (n + 1) == 0 ? 2.0 : 0.0);
    }
    for (int i = 0; i < n; i++) {
      D[i] = (1.0 + 0.5 * random_number()) * (random_number() < 0.0 ? -1.0 : 1.0);
      expected += !pairs && D[i] < 0.0;
    }
    for (int i = 0; i < n; i++) {
      for (int j = 0; j < n; j++) {
        double sum = 0.0;
        for (int k = 0; k < n; k++) {
          sum += B[n * i + k] * D[k] * B[n * j + k];
        }
        A[n * i + j] = !pairs                     ? sum
                       : i / half + j / half == 1 ? B[n * (i < j ? i : j) + (i < j ? j : i) - half]
                       : i < half                 ? 0.0
                                                  : sum;
      }
    }
    found = fbi_negatives(A, n, run % 3 ? 0 : half);
    if (found != expected) {
      printf("matrix %d, %d rows: %d negative eigenvalues, found %d\n", run, n, expected, found);
      exit(1);
    }
  }
}

int main(void)
{
  double differences = 0, dense = 0;
  require_negatives();
  for (int way = 0; way < WAYS; way++) {
    for (int what = 0; what < COMBINATIONS; what++) {
      double e;
      build(what, 2 + what % 3);
      load(what, way);
      scatter(what, way);
      assemble();
      e = compare_differences();
      if (!(e < 1e-6)) {
        printf("way %d, combination %d: the Jacobian is %.1e off\n", way, what, e);
        return 1;
      }
      differences = fmax(differences, e);
      e = compare_dense();
      if (!(e < 1e-9)) {
        printf("way %d, combination %d: elimination and dense LU differ by %.1e\n", way, what, e);
        return 1;
      }
      dense = fmax(dense, e);
    }
  }
  printf("Jacobian of the exact beam in %d combinations within %.1e of differences, chain within %.1e of a dense LU\n",
         WAYS * COMBINATIONS, differences, dense);
  return 0;
}
