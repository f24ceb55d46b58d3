/* exact.h - exact beams as their tests describe, settle and load them, shared by the tests of >>exact:
   the geometrically exact beam against closed forms, the elastica, published cases, other solvers, the
   dispersion relation of its own integrator, and what must be constant. */
#ifndef FBT_EXACT_H
#define FBT_EXACT_H

#include "fbt.h"

static const double pi = 3.14159265358979323846;
static fb_exact_desc desc;
static fb_exact exact;
static fb_exact_state state;
static fb_exact_work work;
static fb_exact_input input;
static fb_exact_node node[FB_MAX_EXACT + 1];
static fb_exact_spectrum spectrum;
static fb_exact_spectrum_work spectrum_work;

/* A uniform beam clamped at its root: stiffness and inertia by their diagonals; nothing acts. */
static inline void beam(double length, int n, const double stiffness[6], const double inertia[6])
{
  memset(&desc, 0, sizeof desc);
  memset(&input, 0, sizeof input);
  desc.length = (fb_real)length;
  desc.n_element = n;
  desc.n_station = 1;
  for (int i = 0; i < 6; i++) {
    desc.station[0].stiffness[7 * i] = (fb_real)stiffness[i];
    desc.station[0].inertia[7 * i] = inertia ? (fb_real)inertia[i] : FB_R(0.0);
  }
}

/* Bends and twists, rigid otherwise: unit length and stiffness. */
static inline void elastica(int n)
{
  const double stiffness[6] = {0.0, 0.0, 0.0, 1.0, 1.0, 1.0}, inertia[6] = {1.0, 1.0, 1.0, 0.0, 0.0, 0.0};
  beam(1.0, n, stiffness, inertia);
}

static inline void start(void)
{
  FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_OK);
  FBT_INT_EQ(fb_exact_check(&exact), FB_OK);
  FBT_INT_EQ(fb_exact_state_init(&exact, &state, &work, &input), FB_OK);
}

static inline void settle(void)
{
  start();
  FBT_INT_EQ(fb_exact_trim(&exact, &state, &work, &input), FB_OK);
  FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
}

static inline void load_tip(fb_axes axes, double fx, double fy, double fz)
{
  fb_load *load = &input.load[input.n_load++];
  load->node = desc.n_element;
  load->axes = axes;
  load->force[0] = (fb_real)fx;
  load->force[1] = (fb_real)fy;
  load->force[2] = (fb_real)fz;
}

static inline double distance(const fb_real *p, double x, double y, double z)
{
  const double a = (double)p[0] - x, b = (double)p[1] - y, c = (double)p[2] - z;
  return sqrt(a * a + b * b + c * c);
}

static inline void spectrum_of(int count)
{
  FBT_INT_EQ(fb_exact_spectrum_solve(&exact, &spectrum_work, &spectrum, &state, &input, count), FB_OK);
}

/* ---- motion */

static inline double total_energy(void)
{
  fb_energy e;
  FBT_INT_EQ(fb_exact_energy_eval(&exact, &e, &state), FB_OK);
  return (double)e.kinetic + (double)e.strain + (double)e.gravity;
}

static inline fb_status steps(int count, double dt)
{
  fb_status status = FB_OK;
  for (int k = 0; k < count && status == FB_OK; k++) {
    status = fb_exact_step(&exact, &state, &work, &input, (fb_real)dt);
  }
  FBT_INT_EQ(status, FB_OK);
  return status;
}

/* 1 m with its mass `offset` ahead of its line, on a hub of 0.1 m that spins about z: of the issue of false growth. */
static inline void mass_ahead(int n, double offset, double spin)
{
  const double stiffness[6] = {2e6, 0.0, 0.0, 30.0, 50.0, 50.0}, m = 0.5;
  fb_real *const M = desc.station[0].inertia;
  beam(1.0, n, stiffness, NULL);
  M[0] = M[7] = M[14] = (fb_real)m;
  M[5] = M[30] = (fb_real)(-m * offset);
  M[15] = M[20] = (fb_real)(m * offset);
  M[21] = M[35] = (fb_real)(m * offset * offset);
  desc.position[0] = FB_R(0.1);
  input.w[2] = (fb_real)spin;
}

/* Integral of Jacobi of a beam on a base that spins about z. */
static inline double jacobi(double spin)
{
  fb_momentum p;
  FBT_INT_EQ(fb_exact_momentum_eval(&exact, &p, &state), FB_OK);
  return total_energy() - spin * (double)p.angular[2];
}

/* ---- the same beam seen another way: 1: with y for z, turned by a right angle about its line, 2: from its other end,
   turned by half a turn about z */

static inline void seen(fb_real v[3], int way)
{
  const fb_real u[3] = {v[0], v[1], v[2]};
  v[0] = way == 2 ? -u[0] : u[0];
  v[1] = way == 2 ? -u[1] : way ? -u[2] : u[1];
  v[2] = way == 1 ? u[1] : u[2];
}

/* A 6x6 of a section: of rates, or (strain) of changes along the line, which from the other end change sign. */
static inline void seen_section(fb_real A[36], int way, int strain)
{
  for (int transposed = 0; transposed < 2; transposed++) {
    fb_real B[36];
    for (int i = 0; i < 36; i++) {
      B[i % 6 * 6 + i / 6] = A[i];
    }
    for (int i = 0; i < 36; i += 3) {
      seen(B + i, way);
      for (int j = 0; j < 3 && way == 2 && strain; j++) {
        B[i + j] = -B[i + j];
      }
    }
    memcpy(A, B, sizeof B);
  }
}

/* Any section: stiffness without a zero, mass off the line. */
static inline void any_section(fb_exact_station *station)
{
  const double m = 1.3, c[2] = {0.12, -0.07}, J[9] = {0.09, 0.004, -0.006, 0.004, 0.05, 0.003, -0.006, 0.003, 0.06};
  fb_real *const K = station->stiffness, *const M = station->inertia, B[36];
  memset(station, 0, sizeof *station);
  fbt_fill(B, 36, 0.3);
  for (int i = 0; i < 36; i++) {
    const double scale = (i / 6 < 3 ? 12.0 : 1.0) * (i % 6 < 3 ? 12.0 : 1.0);
    for (int k = 0; k < 6; k++) {
      K[i] += (fb_real)scale * (B[i / 6 * 6 + k] + (i / 6 == k ? FB_R(1.0) : FB_R(0.0))) *
              (B[i % 6 * 6 + k] + (i % 6 == k ? FB_R(1.0) : FB_R(0.0)));
    }
  }
  for (int i = 0; i < 9; i++) {
    M[(3 + i / 3) * 6 + 3 + i % 3] = (fb_real)J[i];
  }
  M[0] = M[7] = M[14] = (fb_real)m;
  M[4] = M[24] = (fb_real)(m * c[1]);
  M[5] = M[30] = (fb_real)(-m * c[0]);
  M[9] = M[19] = (fb_real)(-m * c[1]);
  M[15] = M[20] = (fb_real)(m * c[0]);
}

/* Loads of every kind at nodes and elements, what moves the base, gravity. */
static inline void any_input(int way, int n)
{
  fbt_fill(desc.gravity, 3, 0.6);
  fbt_fill(input.v, 3, 0.3);
  fbt_fill(input.w, 3, 0.5);
  seen(desc.gravity, way);
  seen(input.v, way);
  seen(input.w, way);
  input.n_load = 3;
  for (int l = 0; l < 3; l++) {
    fb_load *const load = &input.load[l];
    const int at = 2 * l + 1;
    load->node = way == 2 ? n - at : at;
    load->axes = (fb_axes)l;
    fbt_fill(load->force, 3, 0.8);
    fbt_fill(load->torque, 3, 0.3);
    seen(load->force, way);
    seen(load->torque, way);
  }
  for (int k = 0; k < n; k++) {
    fb_line_load *const line = &input.line[way == 2 ? n - 1 - k : k];
    line->axes = (fb_axes)(k % 3);
    fbt_fill(line->force, 3, 0.5);
    fbt_fill(line->torque, 3, 0.2);
    seen(line->force, way);
    seen(line->torque, way);
  }
}

/* A tapered beam of any section with two bodies, clamped at one end, on a slide amid: of the way 1 curved, and
   askew. */
static inline void any_beam(int way, int curved)
{
  const int n = 6;
  memset(&desc, 0, sizeof desc);
  memset(&input, 0, sizeof input);
  fbt_seed(11);
  desc.length = FB_R(1.5);
  desc.n_element = n;
  desc.iterations = 20;
  desc.dissipation = FB_R(0.3);
  desc.n_station = 2;
  any_section(&desc.station[0]);
  fbt_fill(desc.station[0].curvature, 3, 0.4 * curved);
  seen(desc.station[0].curvature, way);
  seen_section(desc.station[0].stiffness, way, 1);
  seen_section(desc.station[0].inertia, way, 0);
  desc.station[1] = desc.station[0];
  desc.station[1].x = desc.length;
  for (int i = 0; i < 36; i++) { /* thinner away from where it is clamped */
    desc.station[way != 2].stiffness[i] *= FB_R(0.6);
    desc.station[way != 2].inertia[i] *= FB_R(0.7);
  }
  desc.root = way == 2 ? FB_END_FREE : FB_END_CLAMPED;
  desc.tip = way == 2 ? FB_END_CLAMPED : FB_END_FREE;
  desc.position[0] = way == 2 ? -desc.length : FB_R(0.0);
  desc.n_support = 1;
  desc.support[0].node = way == 2 ? n - 4 : 4;
  desc.support[0].held = way == 1 ? FB_HOLD_Z | FB_HOLD_RX : FB_HOLD_Y | FB_HOLD_RX;
  if (curved) {
    fbt_fill(desc.attitude, 4, 1.0);
    seen(desc.attitude + 1, way);
  }
  desc.n_lump = 2;
  for (int l = 0; l < 2; l++) {
    fb_lump *const lump = &desc.lump[l];
    const int at = l ? 5 : 2;
    lump->node = way == 2 ? n - at : at;
    lump->mass = FB_R(0.3) + FB_R(0.2) * (fb_real)l;
    fbt_fill(lump->center, 3, 0.1);
    seen(lump->center, way);
    for (int i = 0; i < 3; i++) {
      lump->inertia[i] = FB_R(0.02);
    }
  }
  any_input(way, n);
}

#endif
