/* >>line: poses, velocities, accelerations and inertia of beams that bend far, against a fine integration of the
   differential equations of the line, differences, particles, and the polynomial body at small deflection. */
#include "line.h"

/* ---- poses: E14.1 to E14.4 */

/* Largest errors of a random shape: attitude of the tip [rad], position of tip and of a node between points by the
   length. */
typedef struct pose_error {
  double attitude, tip, inner;
} pose_error;

static double apart(const fb_real *a, const double *b)
{
  return sqrt(((double)a[0] - b[0]) * ((double)a[0] - b[0]) + ((double)a[1] - b[1]) * ((double)a[1] - b[1]) +
              ((double)a[2] - b[2]) * ((double)a[2] - b[2]));
}

static pose_error worst_pose(int shapes, double angle)
{
  static line_pose fine;
  double q[FB_MAX_MODES];
  pose_error worst = {0.0, 0.0, 0.0};
  fb_state state;
  fb_node_motion node;
  line_sample();
  for (int k = 0; k < shapes; k++) {
    fb_real R[9];
    double turned = 0.0;
    line_random(q, angle);
    line_pose_eval(&fine, q);
    line_state(&state, &body, q);
    line_node(&node, &body, &state, 3);
    fb_quat_to_mat33(R, node.quat);
    for (int i = 0; i < 9; i++) {
      turned += 0.5 * ((double)R[i] - fine.H[LINE_STATIONS - 1][i]) * ((double)R[i] - fine.H[LINE_STATIONS - 1][i]);
    }
    worst.attitude = fmax(worst.attitude, sqrt(turned));
    worst.tip = fmax(worst.tip, apart(node.position, fine.r[LINE_STATIONS - 1]) / (double)beam.desc.length);
    line_node(&node, &body, &state, 4);
    worst.inner = fmax(worst.inner, apart(node.position, fine.r[37]) / (double)beam.desc.length);
  }
  return worst;
}

#define DEGREE 0.017453292519943295

/* E14.1, E14.2, E14.3: rotations follow H' = H (sum theta_a' q_a)^, of order 4 in the interval. Random shapes: each
   mode turns the sections by as much times a random number, all of them together by a radian. */
TEST(lines_turn_as_the_differential_equation)
{
  for (int kind = 0; kind < LINE_KINDS; kind++) {
    line_make(kind, 20);
    FBT_BELOW(worst_pose(10, 1.0).attitude, 0.01 * DEGREE);
  }
  {
    double error[2];
    for (int k = 0; k < 2; k++) {
      line_make(LINE_PLAIN, k == 0 ? 12 : 24);
      fbt_seed(1);
      error[k] = worst_pose(20, 1.0).attitude;
    }
    FBT_BELOW(error[1], FBT_TOL(error[0] / 10.0, error[0] / 2.0));
  }
}

/* E14.4: positions follow r' = H (e + sum Gamma_a q_a). */
TEST(lines_reach_where_the_differential_equation_does)
{
  for (int kind = 0; kind < LINE_KINDS; kind++) {
    const double chain = kind == LINE_BENT ? 1e-3 : 0.0; /* ten chords of an arc of 45 degrees are not the arc */
    pose_error e;
    line_make(kind, 20);
    e = worst_pose(FBT_LONG(10, 3), 1.0);
    FBT_BELOW(e.tip, 1e-4 + chain);
    FBT_BELOW(e.inner, 2e-5 + chain);
    e = worst_pose(2, 1e-8); /* undeformed: exact, of bent lines, too */
    FBT_BELOW(e.tip, FBT_TOL(1e-10, 1e-6));
    FBT_BELOW(e.inner, FBT_TOL(1e-10, 1e-6));
  }
  {
    double error[2]; /* a finer chain comes closer to the arc, and both to each other */
    for (int k = 0; k < 2; k++) {
      line_make(LINE_BENT, 20);
      line_chain(10 + 10 * k, 0.7853981633974483, 0);
      line_build();
      error[k] = worst_pose(10, 1.0).tip;
    }
    FBT_BELOW(error[1], 0.5 * error[0]);
  }
}

/* ---- velocities and accelerations: E14.5, E14.9, E14.14 */

/* E14.5, E14.9, E14.14: along q + t q_dot + t^2/2 q_ddot, the frame at rest: velocities and accelerations of nodes are
   derivatives of poses. */
TEST(line_velocities_are_derivatives_of_poses)
{
  const double h = FBT_TOL(2e-3, 4e-2), tol = FBT_TOL(1e-7, 3e-2);
  for (int kind = 0; kind < LINE_KINDS; kind++) {
    double q[FB_MAX_MODES], speed[FB_MAX_MODES], rate[FB_MAX_MODES];
    line_make(kind, 0);
    line_sample();
    line_random(q, 1.0);
    line_random(speed, 1.0);
    line_random(rate, 1.0);
    for (int number = 1; number <= 5; number++) {
      fb_node_motion at[5];
      fb_real R[5][9];
      fb_state state;
      for (int k = 0; k < 5; k++) {
        const double t = (k - 2) * h;
        fb_motion motion;
        memset(&motion, 0, sizeof motion);
        FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
        for (int a = 0; a < body.n; a++) {
          state.q[a] = (fb_real)(q[a] + t * speed[a] + 0.5 * t * t * rate[a]);
          motion.q_dot[a] = (fb_real)(speed[a] + t * rate[a]);
          motion.q_ddot[a] = (fb_real)rate[a];
        }
        FBT_INT_EQ(fb_body_node_motion_eval(&body, &at[k], &state, &motion, number), FB_OK);
        fb_quat_to_mat33(R[k], at[k].quat);
      }
      for (int i = 0; i < 3; i++) {
#define SLOPE(of) ((8.0 * ((double)at[3].of - (double)at[1].of) - ((double)at[4].of - (double)at[0].of)) / (12.0 * h))
        FBT_NEAR_ABS(at[2].velocity[i], SLOPE(position[i]), tol * 4.0);
        FBT_NEAR_ABS(at[2].acceleration[i], SLOPE(velocity[i]), tol * 10.0);
        FBT_NEAR_ABS(at[2].angular_acceleration[i], SLOPE(angular_rate[i]), tol * 10.0);
#undef SLOPE
      }
      /* R_dot R^T */
      for (int i = 0; i < 3; i++) {
        const int row = (i + 2) % 3, column = (i + 1) % 3; /* w_i = (R_dot R^T)_row,column */
        double w = 0.0;
        for (int k = 0; k < 3; k++) {
          const int e = 3 * row + k;
          const double d =
              (8.0 * ((double)R[3][e] - (double)R[1][e]) - ((double)R[4][e] - (double)R[0][e])) / (12.0 * h);
          w += d * (double)R[2][3 * column + k];
        }
        FBT_NEAR_ABS(at[2].angular_rate[i], w, tol * 4.0);
      }
    }
  }
}

/* ---- inertia: E14.6, E14.12 */

typedef struct momenta {
  double kinetic, linear[3], angular[3], pi[FB_MAX_MODES];
} momenta;

/* Velocity of the stations per rate of coordinate a, and the rate of their rotations, by differences. */
static double J_r[FB_MAX_MODES][LINE_STATIONS][3], J_H[FB_MAX_MODES][LINE_STATIONS][9];
static line_pose at_q;

static void particles_jacobians(const double *q)
{
  static line_pose p[4];
  static const double weight[4] = {1.0 / 12.0, -8.0 / 12.0, 8.0 / 12.0, -1.0 / 12.0}, step[4] = {-2.0, -1.0, 1.0, 2.0};
  line_pose_eval(&at_q, q);
  for (int a = 0; a < modes.n; a++) {
    double x[FB_MAX_MODES], size = 0.0, h;
    for (int i = 0; i < LINE_SAMPLES; i++) {
      for (int k = 0; k < 3; k++) {
        size = fmax(size, fmax(fabs(turn[i][a][k]), fabs(shift[i][a][k])));
      }
    }
    h = 1e-3 / size;
    for (int k = 0; k < 4; k++) {
      memcpy(x, q, sizeof x);
      x[a] += step[k] * h;
      line_pose_eval(&p[k], x);
    }
    for (int s = 0; s < LINE_STATIONS; s++) {
      for (int i = 0; i < 9; i++) {
        J_H[a][s][i] = 0.0;
        for (int k = 0; k < 4; k++) {
          J_H[a][s][i] += weight[k] * p[k].H[s][i] / h;
        }
      }
      for (int i = 0; i < 3; i++) {
        J_r[a][s][i] = 0.0;
        for (int k = 0; k < 4; k++) {
          J_r[a][s][i] += weight[k] * p[k].r[s][i] / h;
        }
      }
    }
  }
}

/* Adds a particle at d (undeformed, body axes) from station s, under v, w of the frame and q_dot; pi relative to u. */
static void particle_add(momenta *m, double mass, int s, const double d[3], const double v[3], const double w[3],
                         const double *q_dot, const double u[3])
{
  double x[3], speed[3], J[FB_MAX_MODES][3];
  line_times(x, at_q.H[s], d);
  for (int k = 0; k < 3; k++) {
    x[k] += at_q.r[s][k];
  }
  line_cross(speed, w, x);
  for (int k = 0; k < 3; k++) {
    speed[k] += v[k];
  }
  for (int a = 0; a < modes.n; a++) {
    line_times(J[a], J_H[a][s], d);
    for (int k = 0; k < 3; k++) {
      J[a][k] += J_r[a][s][k];
      speed[k] += J[a][k] * q_dot[a];
    }
  }
  for (int k = 0; k < 3; k++) {
    m->kinetic += 0.5 * mass * speed[k] * speed[k];
    m->linear[k] += mass * speed[k];
    m->angular[k] += mass * (x[(k + 1) % 3] * speed[(k + 2) % 3] - x[(k + 2) % 3] * speed[(k + 1) % 3]);
    for (int a = 0; a < modes.n; a++) {
      m->pi[a] += mass * J[a][k] * (speed[k] - u[k]);
    }
  }
}

/* Body axes from those of the beam's section at x, without its twist. */
static void section_axes(double A[9], double x)
{
  int e = 0;
  double F[9];
  while (e < beam.desc.n_element - 1 && x > (double)beam.start[e + 1]) {
    e++;
  }
  for (int i = 0; i < 9; i++) {
    F[i] = (double)beam.frame[9 * e + i];
  }
  for (int i = 0; i < 9; i++) {
    A[i] = 0.0;
    for (int k = 0; k < 3; k++) {
      A[i] += (double)beam.axes[3 * (i / 3) + k] * F[3 * k + i % 3];
    }
  }
}

/* A body of mass and inertia (beam axes, diagonal and products) about d as particles */
static void rigid_add(momenta *m, const fb_lump *lump, int s, const double v[3], const double w[3], const double *q_dot,
                      const double u[3])
{
  /* with equal diagonal j and product p: pairs along x + y, x - y and z; sums of squares a, b, c along them */
  const double j = (double)lump->inertia[0], p = (double)lump->inertia[3], c = 0.5 * j, mass = (double)lump->mass;
  const double along[3] = {0.5 * j - p, 0.5 * j + p, c};
  static const double axis[3][3] = {{0.70710678118654752, 0.70710678118654752, 0.0},
                                    {0.70710678118654752, -0.70710678118654752, 0.0},
                                    {0.0, 0.0, 1.0}};
  double A[9];
  for (int i = 0; i < 9; i++) {
    A[i] = (double)beam.axes[i];
  }
  for (int k = 0; k < 6; k++) {
    const double reach = (k < 3 ? 1.0 : -1.0) * sqrt(3.0 * along[k % 3] / mass);
    double d[3];
    for (int i = 0; i < 3; i++) {
      d[i] = (double)lump->center[i] + reach * axis[k % 3][i];
    }
    line_times(d, A, d);
    particle_add(m, mass / 6.0, s, d, v, w, q_dot, u);
  }
}

/* Momenta of the whole body by particles: four at each of 101 stations by Simpson's rule, six a lumped body. */
static void particles_eval(momenta *m, const double v[3], const double w[3], const double *q_dot, const double u[3])
{
  const double length = (double)beam.desc.length;
  memset(m, 0, sizeof *m);
  for (int s = 0; s < LINE_STATIONS; s++) {
    /* at a step in the middle both sides, each with its sections */
    for (int side = 0; side < (s > 0 && s < LINE_STATIONS - 1 && s % 2 == 0 ? 2 : 1); side++) {
      const double x = length * s / (LINE_STATIONS - 1), h = length / (LINE_STATIONS - 1);
      const double weight = h / 3.0 * (s % 2 ? 4.0 : 1.0);
      const double nearby = s % 2 ? 0.0 : (s == 0 || (side == 1 && s < LINE_STATIONS - 1) ? 1e-9 : -1e-9);
      const int step = beam.desc.n_station == 4 && s == (LINE_STATIONS - 1) / 2;
      fb_section section;
      double A[9], mass, along[2];
      fb_beam_section_eval(&beam, &section, (fb_real)(x + (step ? 1e7 : 1.0) * nearby));
      section_axes(A, x + length * nearby);
      mass = weight * (double)section.mass;
      along[0] = sqrt(2.0 * (double)section.i_z / (double)section.mass);
      along[1] = sqrt(2.0 * (double)section.i_y / (double)section.mass);
      for (int k = 0; k < 4; k++) {
        const double y = (double)section.mass_y + (k < 2 ? (k ? -1.0 : 1.0) * along[0] : 0.0);
        const double z = (double)section.mass_z + (k < 2 ? 0.0 : (k == 2 ? -1.0 : 1.0) * along[1]);
        const double ct = cos((double)section.twist), st = sin((double)section.twist);
        double d[3] = {0.0, y * ct - z * st, y * st + z * ct};
        line_times(d, A, d);
        particle_add(m, 0.25 * mass, s, d, v, w, q_dot, u);
      }
    }
  }
  for (int k = 0; k < beam.desc.n_lump; k++) {
    rigid_add(m, &beam.desc.lump[k], beam.desc.lump[k].node * (LINE_STATIONS - 1) / beam.desc.n_element, v, w, q_dot,
              u);
  }
  if (beam.desc.root != FB_ROOT_FREE) { /* the hub */
    for (int k = 0; k < 3; k++) {
      m->kinetic += 0.5 * hub_mass * v[k] * v[k] + 0.5 * hub_inertia * w[k] * w[k];
      m->linear[k] += hub_mass * v[k];
      m->angular[k] += hub_inertia * w[k];
    }
  }
}

static void compare_momenta(double angle, double tol)
{
  double q[FB_MAX_MODES], q_dot[FB_MAX_MODES], v[3], w[3], u[3], size = 0.0;
  fb_real v_[3], w_[3], rate[FB_MAX_MODES];
  fb_state state;
  fb_momentum total;
  fb_energy energy;
  momenta m;
  line_sample();
  line_random(q, angle);
  line_random(q_dot, 2.0);
  line_state(&state, &body, q);
  for (int a = 0; a < modes.n; a++) {
    rate[a] = (fb_real)q_dot[a];
  }
  for (int k = 0; k < 3; k++) {
    v_[k] = (fb_real)(v[k] = fbt_random());
    w_[k] = (fb_real)(w[k] = fbt_random());
  }
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, v_, w_, rate), FB_OK);
  FBT_INT_EQ(fb_body_momentum_eval(&body, &total, &state, NULL), FB_OK);
  FBT_INT_EQ(fb_body_energy_eval(&body, &energy, &state, NULL), FB_OK);
  for (int k = 0; k < 3; k++) {
    u[k] = (double)state.u[k];
  }
  particles_jacobians(q);
  particles_eval(&m, v, w, q_dot, u);
  FBT_NEAR_REL(energy.kinetic, m.kinetic, tol);
  for (int k = 0; k < 3; k++) {
    size = fmax(size, fmax(fabs(m.linear[k]), fabs(m.angular[k])));
  }
  for (int k = 0; k < 3; k++) {
    FBT_NEAR_ABS(total.linear[k], m.linear[k], tol * size);
    FBT_NEAR_ABS(total.angular[k], m.angular[k], tol * size);
  }
  size = 0.0;
  for (int a = 0; a < modes.n; a++) {
    size = fmax(size, fabs(m.pi[a]));
  }
  for (int a = 0; a < modes.n; a++) {
    FBT_NEAR_ABS(state.pi[a], m.pi[a], tol * size);
  }
}

/* E14.6: M(q), Lambda(q) and M_rr(q) of every kind of line are those of particles. */
TEST(line_inertia_is_that_of_particles)
{
  for (int kind = 0; kind < LINE_KINDS; kind++) {
    const double chain = kind == LINE_BENT ? 2e-3 : 0.0;
    line_make(kind, 20);
    compare_momenta(1.0, FBT_TOL(1e-4, 2e-4) + chain);
    compare_momenta(0.01, FBT_TOL(1e-5, 1e-4) + chain);
  }
}

/* E14.12: a hub, a beam, a coordinate of an imported component beside them. */
TEST(momenta_of_lines_agree_with_particles)
{
  const fb_real r[3] = {FB_R(0.2), FB_R(-0.4), FB_R(0.3)}, v[3] = {FB_R(0.3), FB_R(-0.2), FB_R(0.5)};
  const fb_real w[3] = {FB_R(0.7), FB_R(0.4), FB_R(-0.6)};
  fb_real psi[3 * FB_MAX_MODES], rate[FB_MAX_MODES];
  double q[FB_MAX_MODES], speed[FB_MAX_MODES], x[3], xd[3];
  const double mass = 2.0;
  fb_state alone, state;
  fb_momentum before, after;
  fb_energy energy[2];
  int n;
  memset(psi, 0, sizeof psi);
  line_make(LINE_SOLID, 0);
  line_sample();
  line_random(q, 1.0);
  line_random(speed, 1.0);
  n = modes.n;

  /* without the component */
  line_state(&alone, &body, q);
  for (int a = 0; a < n; a++) {
    rate[a] = (fb_real)speed[a];
  }
  FBT_INT_EQ(fb_state_from_velocity(&body, &alone, v, w, rate), FB_OK);
  FBT_INT_EQ(fb_body_momentum_eval(&body, &before, &alone, NULL), FB_OK);
  FBT_INT_EQ(fb_body_energy_eval(&body, &energy[0], &alone, NULL), FB_OK);

  /* a particle on a spring along (1, 2, -1) beside the beam, its coordinate the last one */
  FBT_INT_EQ(fb_shape_init(&shape, n + 1), FB_OK);
  {
    const fb_real center[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)}, j = (fb_real)hub_inertia;
    const fb_real inertia[6] = {j, j, j, FB_R(0.0), FB_R(0.0), FB_R(0.0)};
    FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)hub_mass, center, inertia), FB_OK);
  }
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  psi[3 * n] = FB_R(0.5);
  psi[3 * n + 1] = FB_R(1.0);
  psi[3 * n + 2] = FB_R(-0.5);
  FBT_INT_EQ(fb_shape_add_lump(&shape, (fb_real)mass, r, NULL, psi, psi), FB_OK);
  shape.K[n * (n + 1) + n] = FB_R(40.0);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &body_desc), FB_OK);
  q[n] = 0.3;
  speed[n] = -0.8;
  rate[n] = FB_R(-0.8);
  line_state(&state, &body, q);
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, w, rate), FB_OK);
  FBT_INT_EQ(fb_body_momentum_eval(&body, &after, &state, NULL), FB_OK);
  FBT_INT_EQ(fb_body_energy_eval(&body, &energy[1], &state, NULL), FB_OK);
  for (int k = 0; k < 3; k++) {
    x[k] = (double)r[k] + q[n] * (double)psi[3 * n + k];
  }
  for (int k = 0; k < 3; k++) {
    xd[k] = (double)v[k] + (double)w[(k + 1) % 3] * x[(k + 2) % 3] - (double)w[(k + 2) % 3] * x[(k + 1) % 3] +
            speed[n] * (double)psi[3 * n + k];
  }
  for (int k = 0; k < 3; k++) {
    FBT_NEAR_ABS(after.linear[k], (double)before.linear[k] + mass * xd[k], FBT_TOL(1e-7, 2e-5));
    FBT_NEAR_ABS(after.angular[k],
                 (double)before.angular[k] +
                     mass * (x[(k + 1) % 3] * xd[(k + 2) % 3] - x[(k + 2) % 3] * xd[(k + 1) % 3]),
                 FBT_TOL(1e-7, 2e-5));
  }
  FBT_NEAR_REL(energy[1].kinetic,
               (double)energy[0].kinetic + 0.5 * mass * (xd[0] * xd[0] + xd[1] * xd[1] + xd[2] * xd[2]),
               FBT_TOL(1e-7, 1e-5));
}

/* ---- rules and points: E14.10, E14.11 */

/* E14.10: masses of the points of a free beam are the weights of Lobatto quadrature, exact to degree 2 m - 1 for m + 1
   points; the table of integrals from the root to a point is exact to degree m. */
TEST(lobatto_rules_integrate_polynomials)
{
  for (int m = 3; m <= 12; m += 3) {
    const fb_line *line;
    double x[FB_MAX_POINTS];
    line_beam(1.0, 1.0, 1.0, 1.0, 4);
    line_count(1, 0, 0, 0);
    keep.line_points = m;
    beam_desc.root = FB_ROOT_FREE;
    line_solid(0.001, 0.001, 0.0);
    line_lump(0, 1.0, 1.0, 0.0, 0.0, 0.0);
    beam_desc.lump[0].inertia[3] = FB_R(0.0);
    line_build();
    line = &body.lines.line[0];
    FBT_INT_EQ(line->count, m + 1);
    for (int j = 0; j <= m; j++) {
      x[j] = (double)body.lines.start[0][j];
      for (int k = 0; k <= m; k++) {
        x[j] += (double)body.lines.table[line->weight + k * line->stride + j];
      }
    }
    for (int degree = 0; degree < 2 * m; degree++) {
      double sum = 0.0;
      for (int j = 0; j <= m; j++) {
        const double lump = j == 0 ? 1.0 : 0.0;
        sum += ((double)body.lines.mass[j] - lump) * pow(x[j], degree);
      }
      FBT_NEAR_ABS(sum, 1.0 / (degree + 1), FBT_TOL(1e-13, 1e-5));
    }
    for (int degree = 0; degree <= m; degree++) {
      for (int s = 0; s <= m; s++) {
        double sum = 0.0;
        for (int j = 0; j <= m; j++) {
          sum += (double)body.lines.table[line->weight + j * line->stride + s] * pow(x[j], degree);
        }
        FBT_NEAR_ABS(sum, pow(x[s], degree + 1) / (degree + 1), FBT_TOL(1e-12, 1e-5));
      }
    }
  }
}

/* Squares of the frequencies of a free body from unit momenta at rest, M_eff^-1 K. */
static int frequencies(fb_real *omega2, const fb_body *of)
{
  static fb_real A[FB_MAX_MODES * FB_MAX_MODES], vectors[FB_MAX_MODES * FB_MAX_MODES];
  const int n = of->n;
  fb_state state, rate;
  for (int b = 0; b < n; b++) {
    FBT_INT_EQ(fb_state_init(of, &state), FB_OK);
    state.pi[b] = FB_R(1.0);
    FBT_INT_EQ(fb_body_rates_eval(of, &rate, &state, NULL), FB_OK);
    for (int a = 0; a < n; a++) { /* K is diagonal: sqrt(K) M^-1 sqrt(K) */
      A[a * n + b] = (fb_real)(sqrt((double)of->K.diagonal[a] * (double)of->K.diagonal[b]) * (double)rate.q[a]);
    }
  }
  for (int a = 0; a < n; a++) {
    for (int b = 0; b < a; b++) {
      A[a * n + b] = A[b * n + a] = FB_R(0.5) * (A[a * n + b] + A[b * n + a]);
    }
  }
  FBT_INT_EQ(fb_eig_sym_solve(omega2, vectors, A, n), FB_OK);
  return n;
}

/* E14.11: with the default number of points random shapes of 1 rad, each mode with the same share, reach to 0.05 % of the
   length and turn to 0.05 degrees, with up to 6 modes in one plane and in both. */
TEST(default_points_reach_far_shapes_of_many_modes)
{
  pose_error most[2] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  for (int planes = 1; planes <= 2; planes++) {
    for (int n = 1; n <= 6; n++) {
      for (int other = planes == 2 && n > 2 ? 2 : n; other <= n; other += n > 2 ? n - 2 : 1) { /* of both planes */
        pose_error e;
        line_beam(2.0, 1.0, 20.0, 30.0, 16);
        line_count(n, planes == 2 ? other : 0, 0, 0);
        line_build();
        FBT_TRUE(modes.line_points <= FB_MAX_POINTS);
        e = worst_pose(FBT_LONG(60, 6), 1.0);
        FBT_BELOW(e.tip, 5e-4);
        FBT_BELOW(e.attitude, 0.05 * DEGREE);
        most[planes - 1].tip = fmax(most[planes - 1].tip, e.tip);
        most[planes - 1].attitude = fmax(most[planes - 1].attitude, e.attitude);
      }
    }
  }
  fbt_figure("bending in one plane, random shapes of 1 rad: tip, by the length", "fine integration", most[0].tip);
  fbt_figure("bending in two planes, random shapes of 1 rad: tip, by the length", "fine integration", most[1].tip);
  fbt_figure("bending in two planes, random shapes of 1 rad: attitude [rad]", "fine integration", most[1].attitude);
}

/* What the points of a body of beams alone miss of its mass matrix, relative: twice the error that the frequencies would
   have if E14.12 did not add it. */
static double missed(void)
{
  double most = 0.0;
  for (int a = 0; a < body.n; a++) {
    most = fmax(most, fabs((double)body.M_rest.diagonal[a] / (double)shape.M[a * body.n + a]));
  }
  for (int k = 0; k < body.M_rest.n_term; k++) {
    const fb_pair_term *const t = &body.M_rest.term[k];
    const double size = sqrt((double)shape.M[t->a * body.n + t->a] * (double)shape.M[t->b * body.n + t->b]);
    most = fmax(most, fabs((double)t->c) / size);
  }
  return most;
}

/* E14.11: with the default number of points linear frequencies are those of the polynomial body, also of the points
   alone. */
TEST(lines_have_enough_points)
{
  double most = 0.0, points = 0.0;
  for (int kind = 0; kind < LINE_KINDS; kind++) {
    for (int more = 0; more < 2; more++) {
      fb_real a[FB_MAX_MODES], b[FB_MAX_MODES];
      int n;
      if (kind == LINE_KINKED || (more && kind != LINE_PLAIN && kind != LINE_FREE)) {
        continue; /* K is not diagonal */
      }
      line_make(kind, 0);
      if (more) {
        line_count(5, 5, 0, 0);
        line_build();
      }
      n = frequencies(a, &body);
      (void)frequencies(b, &full);
      FBT_BELOW(0.5 * missed(), kind == LINE_BENT ? 1e-3 : more ? 1e-4 : FBT_TOL(2e-6, 1e-4));
      points = kind == LINE_BENT || more ? points : fmax(points, 0.5 * missed());
      for (int k = 0; k < n; k++) {
        const double error = fabs(sqrt((double)a[k] / (double)b[k]) - 1.0);
        most = kind == LINE_BENT ? most : fmax(most, error);
        FBT_BELOW(error, kind == LINE_BENT ? 2e-3 : FBT_TOL(1e-6, 1e-4));
      }
    }
  }
  fbt_figure("frequencies of a large-deflection body at rest", "polynomial body", most);
  if (!FB_SINGLE) {
    fbt_figure("the same by the points alone", "polynomial body", points);
  }
}

/* ---- sections that change fast */

/* Station at x of the length: mass and stiffness by those of station 0. */
static void section_at(int k, double x, double mass, double stiffness)
{
  fb_section *const s = &beam_desc.station[k];
  *s = beam_desc.station[0];
  s->x = (fb_real)(x * (double)beam_desc.length);
  s->mass = (fb_real)mass;
  s->EI_y *= (fb_real)stiffness;
  s->EI_z *= (fb_real)stiffness;
  beam_desc.n_station = k + 1;
}

/* Largest errors of the potential energy in gravity along y, by that of all mass lifted by the length, over shapes of
   1 rad in which higher modes have less: against Simpson's rule along the fine integration. */
static double worst_weight(void)
{
  static line_pose fine;
  const double g = 10.0, length = (double)beam.desc.length, h = length / (LINE_STATIONS - 1);
  double worst = 0.0;
  line_sample();
  for (int k = 0; k < 20; k++) {
    double q[FB_MAX_MODES], judge = 0.0;
    fb_state state;
    fb_energy e;
    line_random(q, 1.0);
    for (int a = 0; a < modes.n; a++) {
      q[a] /= (1.0 + a) * (1.0 + a);
    }
    line_pose_eval(&fine, q);
    line_state(&state, &body, q);
    FBT_INT_EQ(fb_body_energy_eval(&body, &e, &state, NULL), FB_OK);
    for (int s = 0; s < LINE_STATIONS; s++) {
      fb_section at;
      fb_beam_section_eval(&beam, &at, (fb_real)(h * s));
      judge += (s == 0 || s == LINE_STATIONS - 1 ? 1.0
                : s % 2                          ? 4.0
                                                 : 2.0) *
               h / 3.0 * g * (double)at.mass * fine.r[s][1];
    }
    worst = fmax(worst, fabs((double)e.gravity - judge) / (g * (double)beam.mass * length));
  }
  return worst;
}

/* E14.11: mass that changes thirtyfold within a fiftieth of the length or a thirtieth, in the middle, at a heavy head,
   as a spike; ramps begin and end at even stations. */
TEST(ramps_of_mass_are_where_they_belong)
{
  static const double ramp[4][2] = {{0.48, 0.5}, {0.92, 0.94}, {0.92, 0.98}, {0.5, 0.52}};
  for (int k = 0; k < 4; k++) {
    line_beam(2.0, 1.0, 20.0, 30.0, 20);
    line_count(3, 3, 0, 0);
    section_at(1, ramp[k][0], 1.0, 1.0);
    section_at(2, ramp[k][1], 30.0, 1.0);
    section_at(3, k < 3 ? 1.0 : 0.54, k < 3 ? 30.0 : 1.0, 1.0);
    if (k == 3) {
      section_at(4, 1.0, 1.0, 1.0);
    }
    body_desc.effects |= (unsigned)FB_EFFECT_GRAVITY;
    body_desc.gravity[1] = FB_R(-10.0);
    line_build();
    FBT_BELOW(worst_weight(), FBT_TOL(1e-4, 2e-4));
  }
}

/* E14.18: the table of a blade has more steps than lines have room for: those that matter stay. Eight decades of
   stiffness, at the tip a quarter less every two hundredths of a radius. */
TEST(tables_of_blades_are_lines)
{
  if (FB_SINGLE) { /* its modes want double precision */
    return;
  }
  for (int points = 0; points <= 4; points += 4) {
    line_beam(2.0, 1.0, 2000.0, 3000.0, 20);
    line_count(3, 3, 0, 0);
    for (int k = 1; k <= 45; k++) {
      const double x = 0.02 * k;
      section_at(k, x, exp(-2.0 * x), exp(-6.0 * x));
    }
    for (int k = 1; k <= 10; k++) {
      const double x = 0.9 + 0.01 * k;
      section_at(45 + k, x, exp(-2.0 * x - 10.0 * (x - 0.9)), exp(-6.0 * x - 28.0 * (x - 0.9)));
    }
    for (int k = 46; k < beam_desc.n_station - 1; k += 2) { /* then they are steps, by either rule */
      beam_desc.station[k].x -= FB_R(1e-3);
    }
    body_desc.effects |= (unsigned)FB_EFFECT_GRAVITY;
    body_desc.gravity[1] = FB_R(-10.0);
    keep.line_points = points;
    line_build();
    FBT_TRUE(body.lines.n_point <= (points ? 3 * points : FB_MAX_POINTS));
    FBT_BELOW(worst_weight(), points ? 2e-3 : 1e-4);
  }
}

/* ---- ties to the polynomial body at small deflection */

/* Momenta about the inertial origin at coordinates h x, with velocities v, w, q_dot. */
static void momentum_at(double out[6], const fb_body *of, const double *x, double h, const fb_real v[3],
                        const fb_real w[3], const fb_real *q_dot)
{
  double q[FB_MAX_MODES];
  fb_state state;
  fb_momentum m;
  for (int a = 0; a < of->n; a++) {
    q[a] = h * x[a];
  }
  line_state(&state, of, q);
  FBT_INT_EQ(fb_state_from_velocity(of, &state, v, w, q_dot), FB_OK);
  FBT_INT_EQ(fb_body_momentum_eval(of, &m, &state, NULL), FB_OK);
  for (int k = 0; k < 3; k++) {
    out[k] = (double)m.linear[k];
    out[3 + k] = (double)m.angular[k];
  }
}

/* First and second derivative by h at 0 */
static void momentum_derivatives(double first[6], double second[6], const fb_body *of, const double *x, double h,
                                 const fb_real v[3], const fb_real w[3], const fb_real *q_dot)
{
  double y[5][6];
  for (int k = 0; k < 5; k++) {
    momentum_at(y[k], of, x, (k - 2) * h, v, w, q_dot);
  }
  for (int i = 0; i < 6; i++) {
    first[i] = (8.0 * (y[3][i] - y[1][i]) - (y[4][i] - y[0][i])) / (12.0 * h);
    second[i] = (16.0 * (y[3][i] + y[1][i] - 2.0 * y[2][i]) - (y[4][i] + y[0][i] - 2.0 * y[2][i])) / (12.0 * h * h);
  }
}

/* E14.6: M(0), Lambda to the first degree and M_rr to the second, of straight beams that bend, are those of the
   polynomial body. */
TEST(lines_begin_as_the_polynomial_body)
{
  const int kinds[3] = {LINE_PLAIN, LINE_PINNED, LINE_TWISTED}; /* of free roots the frames differ, to degree 2 */
  for (int k = 0; k < 3; k++) {
    const fb_real still[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)};
    const double tol = FBT_TOL(kinds[k] == LINE_TWISTED ? 1e-6 : 1e-7, 2e-3); /* twist: both integrate by quadrature */
    double x[FB_MAX_MODES];
    line_make(kinds[k], 20);
    keep.lowest = 0;
    line_count(2, 2, 0, 0);
    for (int i = 0; i < beam_desc.n_station; i++) {
      beam_desc.station[i].GJ = FB_R(0.0); /* with torsion the coordinates differ by a quadratic change */
    }
    beam_desc.n_element = 1; /* modes of one polynomial, which points integrate best */
    line_build();
    line_sample();
    for (int trial = 0; trial < 3; trial++) {
      fb_real v[3], w[3], q_dot[FB_MAX_MODES], none[FB_MAX_MODES];
      double a[6], b[6], a2[6], b2[6], size = 0.0;
      fb_state s[2];
      memset(none, 0, sizeof none);
      fbt_fill(v, 3, 1.0);
      fbt_fill(w, 3, 1.0);
      line_random(x, 1.0);
      for (int i = 0; i < body.n; i++) {
        q_dot[i] = (fb_real)x[i];
      }
      line_random(x, 1.0);

      /* M(0), Lambda(0): elastic momenta */
      for (int of = 0; of < 2; of++) {
        const fb_body *const B = of ? &full : &body;
        FBT_INT_EQ(fb_state_init(B, &s[of]), FB_OK);
        FBT_INT_EQ(fb_state_from_velocity(B, &s[of], v, w, q_dot), FB_OK);
      }
      for (int i = 0; i < body.n; i++) {
        FBT_NEAR_ABS(s[0].pi[i], s[1].pi[i], FBT_TOL(1e-7, 1e-4) * fbt_largest(s[1].pi, body.n));
      }

      /* Lambda: the frame at rest; M_rr: q_dot = 0 */
      momentum_derivatives(a, a2, &body, x, FBT_TOL(0.008, 0.1), still, still, q_dot);
      momentum_derivatives(b, b2, &full, x, FBT_TOL(0.008, 0.1), still, still, q_dot);
      for (int i = 0; i < 6; i++) {
        size = fmax(size, fabs(b[i]));
      }
      for (int i = 0; i < 6; i++) {
        FBT_NEAR_ABS(a[i], b[i], tol * fmax(size, 1.0));
      }
      momentum_derivatives(a, a2, &body, x, FBT_TOL(0.008, 0.1), v, w, none);
      momentum_derivatives(b, b2, &full, x, FBT_TOL(0.008, 0.1), v, w, none);
      for (int i = 0; i < 6; i++) {
        FBT_NEAR_ABS(a[i], b[i], tol * fmax(size, 1.0));
        FBT_NEAR_ABS(a2[i], b2[i], FBT_TOL(10.0 * tol, 5e-2) * fmax(size, 1.0));
      }
    }
  }
}

/* Of a free body at coordinates h x: energy at elastic momenta pi, the mass center at rest, angular momentum L; traces
   of the inertia about the mass center and of its square. */
static void free_at(double out[3], const fb_body *of, const double *x, double h, const fb_real *pi, const fb_real L[3])
{
  static const fb_real still[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)}, none[FB_MAX_MODES] = {FB_R(0.0)};
  double q[FB_MAX_MODES];
  fb_state state;
  for (int a = 0; a < of->n; a++) {
    q[a] = h * x[a];
  }
  line_state(&state, of, q);
  memcpy(state.pi, pi, (size_t)of->n * sizeof *pi);
  memcpy(state.L, L, sizeof state.L);
  out[0] = line_energy(of, &state, NULL);
  out[1] = out[2] = 0.0;
  for (int i = 0; i < 3; i++) {
    const fb_real w[3] = {(fb_real)(i == 0), (fb_real)(i == 1), (fb_real)(i == 2)};
    line_state(&state, of, q);
    FBT_INT_EQ(fb_state_from_velocity(of, &state, still, w, none), FB_OK);
    out[1] += (double)state.L[i];
    out[2] += (double)fb_vec3_dot(state.L, state.L);
  }
}

/* E14.6: beams with free roots, whose frame is not that of the polynomial body from degree 2 on. What does not know the
   frame is the same: the inertia about the mass center to the second degree; M, Lambda and M_rr by the energy at given
   momenta, without angular momentum or in one plane, to the first. */
TEST(free_lines_begin_as_the_polynomial_body)
{
  for (int k = 0; k < 6; k++) {
    const double h = FBT_TOL(0.01, 0.1);
    double x[FB_MAX_MODES], y[2][5][3];
    fb_real pi[FB_MAX_MODES], L[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)};
    line_beam(2.0, 1.0, 20.0, 30.0, 1);
    beam_desc.root = FB_ROOT_FREE;
    beam_desc.position[0] = -FB_R(0.9);
    line_lump(0, 3.0, 0.5, 0.0, 0.0, 0.0);
    beam_desc.lump[0].inertia[3] = FB_R(0.0); /* or M(q) had a term of the first degree, which is left out */
    keep.line_points = 20;
    line_count(k < 3 ? 2 : 0, 2, 0, 0);
    line_build();
    line_sample();
    line_random(x, 1.0);
    fbt_fill(pi, body.n, 1.0);
    if (k >= 3) {
      fbt_fill(L, 3, 2.0);
    }
    for (int of = 0; of < 2; of++) {
      for (int i = 0; i < 5; i++) {
        free_at(y[of][i], of ? &full : &body, x, (i - 2) * h, pi, L);
      }
    }
    for (int what = 0; what < 3; what++) {
      double d[2][3];
      for (int of = 0; of < 2; of++) {
        const double z[5] = {y[of][0][what], y[of][1][what], y[of][2][what], y[of][3][what], y[of][4][what]};
        d[of][0] = z[2];
        d[of][1] = (8.0 * (z[3] - z[1]) - (z[4] - z[0])) / (12.0 * h);
        d[of][2] = (16.0 * (z[3] + z[1] - 2.0 * z[2]) - (z[4] + z[0] - 2.0 * z[2])) / (12.0 * h * h);
      }
      for (int degree = 0; degree < (what ? 3 : 2); degree++) {
        FBT_NEAR_ABS(d[0][degree], d[1][degree], FBT_TOL(degree < 2 ? 1e-7 : 1e-6, 1e-2) * fmax(d[1][0], 1.0));
      }
    }
  }
}

SUITE(line_kinematics, RUN_LONG(lines_turn_as_the_differential_equation),
      RUN_LONG(lines_reach_where_the_differential_equation_does), RUN(line_velocities_are_derivatives_of_poses),
      RUN_LONG(line_inertia_is_that_of_particles), RUN(momenta_of_lines_agree_with_particles),
      RUN(lobatto_rules_integrate_polynomials), RUN(lines_have_enough_points),
      RUN_LONG(default_points_reach_far_shapes_of_many_modes), RUN(ramps_of_mass_are_where_they_belong),
      RUN_LONG(tables_of_blades_are_lines), RUN(lines_begin_as_the_polynomial_body),
      RUN_LONG(free_lines_begin_as_the_polynomial_body))
