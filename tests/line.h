/* line.h - beams that bend far, shared by the tests of >>line and of FB_EFFECT_LARGE_DEFLECTION. The judge of
   kinematics and inertia is a fine integration of H' = H (theta' q)^, r' = H (e + u' q - theta q x e) on 401 samples of
   the modes, in body axes, by products of exponentials of two meshes, extrapolated; it uses none of the library's
   points, weights or rotation vectors. */
#ifndef FBT_LINE_H
#define FBT_LINE_H

#include "fbt.h"

#define LINE_SAMPLES 401
#define LINE_STATIONS 101 /* where the two meshes meet: every fourth sample */

/* A beam, its modes and the bodies made of them, with lines and without: of the full set. */
static fb_beam_desc beam_desc;
static fb_modes_desc keep;
static fb_body_desc body_desc;
static double hub_mass, hub_inertia; /* [kg], [kg m^2] at O */
static fb_beam beam;
static fb_modes modes;
static fb_modes_work modes_work;
static fb_shape shape;
static fb_body_work body_work;
static fb_body body, full;

/* Undeformed places and the modes' displacements and rotations along the beam, body axes. */
static double place[LINE_SAMPLES][3], shift[LINE_SAMPLES][FB_MAX_MODES][3], turn[LINE_SAMPLES][FB_MAX_MODES][3];

/* A uniform straight beam, stiff in shear and torsion, one element per default of the caller. */
static inline void line_beam(double length, double mass, double EI_y, double EI_z, int n_element)
{
  memset(&beam_desc, 0, sizeof beam_desc);
  memset(&keep, 0, sizeof keep);
  memset(&body_desc, 0, sizeof body_desc);
  hub_mass = 10.0;
  hub_inertia = 5.0;
  beam_desc.length = (fb_real)length;
  beam_desc.n_element = n_element;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = (fb_real)mass;
  beam_desc.station[0].EI_y = (fb_real)EI_y;
  beam_desc.station[0].EI_z = (fb_real)EI_z;
  body_desc.effects = FB_EFFECTS_LARGE;
  body_desc.allow_long_step = 1;
  body_desc.deflection_limit = (fb_real)(100.0 * length);
}

static inline void line_count(int y, int z, int axial, int torsion)
{
  keep.count[FB_KIND_BEND_Y] = y;
  keep.count[FB_KIND_BEND_Z] = z;
  keep.count[FB_KIND_AXIAL] = axial;
  keep.count[FB_KIND_TORSION] = torsion;
}

static inline void line_load_mode(int node, int axis)
{
  keep.load[keep.n_load].node = node;
  keep.load[keep.n_load].axis = axis;
  keep.n_load++;
}

/* Bodies of the beam, with nodes 1, 2, 3 at root, middle and tip, 4 at 0.37 of the length, one between points, and 5 before
   the first point. */
static inline void line_build(void)
{
  static const double at[] = {0.0, 0.5, 1.0, 0.37, 0.003};
  fb_body_desc plain = body_desc;
  int node;
  plain.effects &= ~(unsigned)FB_EFFECT_LARGE_DEFLECTION;
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  if (hub_mass > 0.0 && beam_desc.root != FB_ROOT_FREE) {
    const fb_real center[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)}, j = (fb_real)hub_inertia;
    const fb_real inertia[6] = {j, j, j, FB_R(0.0), FB_R(0.0), FB_R(0.0)};
    FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)hub_mass, center, inertia), FB_OK);
  }
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  for (int k = 0; k < FBT_COUNT(at); k++) {
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, (fb_real)at[k] * beam.desc.length), FB_OK);
  }
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &body_desc), FB_OK);
  FBT_INT_EQ(fb_body_init(&full, &body_work, &shape, &plain), FB_OK);
}

/* Samples of the modes along the beam. */
static inline void line_sample(void)
{
  const int n_node = shape.n_node;
  int node;
  for (int i = 0; i < LINE_SAMPLES; i++) {
    const double x = (double)beam.desc.length * i / (LINE_SAMPLES - 1);
    shape.n_node = 1;
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, (fb_real)x), FB_OK);
    for (int k = 0; k < 3; k++) {
      place[i][k] = (double)shape.node[1].r[k];
      for (int a = 0; a < modes.n; a++) {
        shift[i][a][k] = (double)shape.node[1].psi[3 * a + k];
        turn[i][a][k] = (double)shape.node[1].theta[3 * a + k];
      }
    }
  }
  shape.n_node = n_node;
}

/* ---- fine integration */

static inline void line_cross(double c[3], const double a[3], const double b[3])
{
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

static inline void line_times(double y[3], const double A[9], const double x[3])
{
  const double u[3] = {x[0], x[1], x[2]};
  for (int i = 0; i < 3; i++) {
    y[i] = A[3 * i] * u[0] + A[3 * i + 1] * u[1] + A[3 * i + 2] * u[2];
  }
}

/* A := A exp(phi^) */
static inline void line_turn(double A[9], const double phi[3])
{
  const double angle = sqrt(phi[0] * phi[0] + phi[1] * phi[1] + phi[2] * phi[2]), half = sin(0.5 * angle);
  const double s = angle > 0.0 ? sin(angle) / angle : 1.0;
  const double c = angle > 0.0 ? 2.0 * half * half / (angle * angle) : 0.5;
  const double W[9] = {0.0, -phi[2], phi[1], phi[2], 0.0, -phi[0], -phi[1], phi[0], 0.0};
  double E[9], B[9];
  for (int i = 0; i < 9; i++) {
    E[i] = i % 4 ? 0.0 : 1.0;
    for (int k = 0; k < 3; k++) {
      E[i] += c * W[3 * (i / 3) + k] * W[3 * k + i % 3];
    }
    E[i] += s * W[i];
  }
  for (int i = 0; i < 9; i++) {
    B[i] = 0.0;
    for (int k = 0; k < 3; k++) {
      B[i] += A[3 * (i / 3) + k] * E[3 * k + i % 3];
    }
  }
  memcpy(A, B, sizeof B);
}

/* sum theta_a q_a at sample i less that at sample j, j < 0: all of it; likewise displacements */
static inline void line_sum(double y[3], double field[LINE_SAMPLES][FB_MAX_MODES][3], int i, int j, const double *q)
{
  for (int k = 0; k < 3; k++) {
    y[k] = 0.0;
    for (int a = 0; a < modes.n; a++) {
      y[k] += q[a] * (field[i][a][k] - (j < 0 ? 0.0 : field[j][a][k]));
    }
  }
}

typedef struct line_pose {
  double r[LINE_STATIONS][3], H[LINE_STATIONS][9]; /* body axes */
} line_pose;

/* On a mesh of `step` samples, step 2 or 4 */
static inline void line_pose_of(line_pose *p, const double *q, int step)
{
  double H[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}, r[3], phi[3];
  line_sum(r, shift, 0, -1, q);
  line_sum(phi, turn, 0, -1, q);
  line_turn(H, phi);
  for (int k = 0; k < 3; k++) {
    r[k] += place[0][k];
  }
  for (int i = 0; i < LINE_SAMPLES; i += step) {
    if (i % 4 == 0) {
      memcpy(p->r[i / 4], r, sizeof r);
      memcpy(p->H[i / 4], H, sizeof H);
    }
    if (i + step < LINE_SAMPLES) {
      const int middle = i + step / 2, end = i + step;
      double M[9], e[3], u[3], more[3];
      for (int k = 0; k < 3; k++) {
        e[k] = place[end][k] - place[i][k];
      }
      memcpy(M, H, sizeof M);
      line_sum(phi, turn, middle, i, q);
      line_turn(M, phi);
      line_sum(u, shift, end, i, q);
      line_sum(phi, turn, middle, -1, q);
      line_cross(more, phi, e);
      for (int k = 0; k < 3; k++) {
        e[k] += u[k] - more[k];
      }
      line_times(u, M, e);
      for (int k = 0; k < 3; k++) {
        r[k] += u[k];
      }
      line_sum(phi, turn, end, i, q);
      line_turn(H, phi);
    }
  }
}

/* Both meshes, extrapolated; their errors are of the order of the square of the interval. */
static inline void line_pose_eval(line_pose *p, const double *q)
{
  static line_pose coarse;
  line_pose_of(p, q, 2);
  line_pose_of(&coarse, q, 4);
  for (int s = 0; s < LINE_STATIONS; s++) {
    for (int k = 0; k < 3; k++) {
      p->r[s][k] += (p->r[s][k] - coarse.r[s][k]) / 3.0;
    }
    for (int k = 0; k < 9; k++) {
      p->H[s][k] += (p->H[s][k] - coarse.H[s][k]) / 3.0;
    }
  }
}

/* ---- states */

/* Random coordinates of which each mode turns the sections alike, scaled so that sum |theta_a q_a| turns by `angle`
   at most. */
static inline void line_random(double *q, double angle)
{
  double most = 0.0;
  for (int a = 0; a < modes.n; a++) {
    double size = 0.0, move = 0.0;
    for (int i = 0; i < LINE_SAMPLES; i++) {
      const double *t = turn[i][a], *u = shift[i][a];
      size = fmax(size, sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]));
      move = fmax(move, sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]));
    }
    /* an axial mode does not turn: a tenth of the angle as stretch */
    q[a] = fbt_random() / fmax(size, 10.0 * move / (double)beam.desc.length);
  }
  for (int i = 0; i < LINE_SAMPLES; i++) {
    double t[3];
    line_sum(t, turn, i, -1, q);
    most = fmax(most, sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]));
  }
  for (int a = 0; a < modes.n; a++) {
    q[a] *= angle / most;
  }
}

static inline void line_state(fb_state *state, const fb_body *of, const double *q)
{
  FBT_INT_EQ(fb_state_init(of, state), FB_OK);
  for (int a = 0; a < of->n; a++) {
    state->q[a] = (fb_real)q[a];
  }
}

/* Node pose at q, the frame at the origin. */
static inline void line_node(fb_node_motion *out, const fb_body *of, const fb_state *state, int node)
{
  static fb_motion none;
  FBT_INT_EQ(fb_body_node_motion_eval(of, out, state, &none, node), FB_OK);
}

static inline double line_energy(const fb_body *of, const fb_state *state, const fb_input *input)
{
  fb_energy e;
  FBT_INT_EQ(fb_body_energy_eval(of, &e, state, input), FB_OK);
  return (double)e.kinetic + (double)e.strain + (double)e.gravity;
}

/* ---- beams of every kind that a line can be */

enum {
  LINE_PLAIN,   /* bending in two planes */
  LINE_SOLID,   /* torsion, rotary inertia, centers of mass off the line; turned and off O */
  LINE_PINNED,  /* at its root */
  LINE_FREE,    /* the whole body, with torsion */
  LINE_SHEARED, /* Timoshenko beam that stretches, tension center off the line */
  LINE_BENT,    /* an arc of 45 degrees as a chain */
  LINE_TWISTED, /* tapered and twisted by a radian */
  LINE_STEPPED, /* a step in stiffness and mass, lumped bodies off center; turned */
  LINE_KINKED,  /* by 60 degrees in the middle, a component with the tip as boundary */
  LINE_KINDS
};

static inline void line_solid(double i_y, double i_z, double GJ)
{
  beam_desc.station[0].i_y = (fb_real)i_y;
  beam_desc.station[0].i_z = (fb_real)i_z;
  beam_desc.station[0].GJ = (fb_real)GJ;
}

static inline void line_turned(void)
{
  beam_desc.position[0] = FB_R(0.3);
  beam_desc.position[1] = FB_R(-0.2);
  beam_desc.position[2] = FB_R(0.1);
  beam_desc.attitude[0] = FB_R(0.8);
  beam_desc.attitude[1] = FB_R(0.1);
  beam_desc.attitude[2] = FB_R(0.5);
  beam_desc.attitude[3] = FB_R(0.3162277660168379); /* 1 - 0.64 - 0.01 - 0.25 */
}

/* Chain of n elements through an arc of `angle`, or with a kink of it in the middle. */
static inline void line_chain(int n, double angle, int kink)
{
  double length = 0.0;
  beam_desc.n_element = n;
  beam_desc.n_point = n + 1;
  for (int k = 1; k <= n; k++) {
    const double h = (double)beam_desc.length / n, at = kink ? (k > n / 2 ? angle : 0.0) : angle * (k - 0.5) / n;
    beam_desc.point[k][0] = (fb_real)((double)beam_desc.point[k - 1][0] + h * cos(at));
    beam_desc.point[k][1] = (fb_real)((double)beam_desc.point[k - 1][1] + h * sin(at));
  }
  for (int k = 1; k <= n; k++) {
    length += hypot((double)beam_desc.point[k][0] - (double)beam_desc.point[k - 1][0],
                    (double)beam_desc.point[k][1] - (double)beam_desc.point[k - 1][1]);
  }
  beam_desc.length = (fb_real)length;
}

static inline void line_station(int k, double x, double scale, double twist)
{
  fb_section *const s = &beam_desc.station[k];
  *s = beam_desc.station[0];
  s->x = (fb_real)x;
  s->mass *= (fb_real)scale;
  s->i_y *= (fb_real)scale;
  s->i_z *= (fb_real)scale;
  s->EI_y *= (fb_real)scale;
  s->EI_z *= (fb_real)scale;
  s->GJ *= (fb_real)scale;
  s->twist = (fb_real)twist;
  beam_desc.n_station = k + 1;
}

static inline void line_lump(int node, double mass, double inertia, double x, double y, double z)
{
  fb_lump *const lump = &beam_desc.lump[beam_desc.n_lump++];
  lump->node = node;
  lump->mass = (fb_real)mass;
  lump->inertia[0] = lump->inertia[1] = lump->inertia[2] = (fb_real)inertia;
  lump->inertia[3] = (fb_real)(0.2 * inertia);
  lump->center[0] = (fb_real)x;
  lump->center[1] = (fb_real)y;
  lump->center[2] = (fb_real)z;
}

/* That beam with bodies; points: keep.line_points. */
static inline void line_make(int kind, int points)
{
  line_beam(2.0, 1.0, 20.0, 30.0, 10);
  line_count(2, 2, 0, 0);
  keep.line_points = points;
  switch (kind) {
  case LINE_SOLID:
    line_solid(0.02, 0.03, 12.0);
    line_count(2, 2, 0, 1);
    line_turned();
    beam_desc.station[0].mass_y = FB_R(0.05);
    beam_desc.station[0].mass_z = FB_R(-0.03);
    break;
  case LINE_PINNED:
    beam_desc.root = FB_ROOT_PINNED;
    break;
  case LINE_FREE:
    beam_desc.root = FB_ROOT_FREE;
    beam_desc.position[0] = FB_R(-0.9);
    line_solid(0.02, 0.03, 12.0);
    line_count(2, 2, 0, 1);
    line_lump(0, 3.0, 0.5, 0.0, 0.0, 0.0);
    break;
  case LINE_SHEARED:
    line_count(2, 2, 1, 0);
    beam_desc.station[0].EA = FB_R(3000.0);
    beam_desc.station[0].GA_y = FB_R(400.0);
    beam_desc.station[0].GA_z = FB_R(300.0);
    beam_desc.station[0].tension_y = FB_R(0.02);
    line_turned();
    break;
  case LINE_BENT:
    line_solid(0.02, 0.02, 25.0);
    beam_desc.station[0].EA = FB_R(1e5);
    line_count(0, 0, 0, 0);
    keep.lowest = 4;
    line_chain(10, 0.7853981633974483, 0);
    line_turned();
    break;
  case LINE_TWISTED:
    line_solid(0.02, 0.03, 12.0);
    line_count(0, 0, 0, 0);
    keep.lowest = 4;
    line_station(1, 1.0, 0.8, 0.5);
    line_station(2, 2.0, 0.6, 1.0);
    break;
  case LINE_STEPPED:
    line_station(1, 0.9999, 1.0, 0.0);
    line_station(2, 1.0001, 0.5, 0.0);
    line_station(3, 2.0, 0.5, 0.0);
    line_lump(10, 0.5, 0.02, 0.05, 0.1, -0.04);
    line_lump(3, 0.4, 0.01, 0.0, -0.1, 0.1);
    line_turned();
    break;
  case LINE_KINKED:
    line_solid(0.02, 0.02, 25.0);
    beam_desc.station[0].EA = FB_R(1e5);
    line_count(1, 1, 0, 0);
    keep.basis = FB_BASIS_COMPONENT;
    keep.n_boundary = 3;
    for (int k = 0; k < 3; k++) {
      keep.boundary[k].node = 10;
      keep.boundary[k].axis = k + 3;
    }
    line_chain(10, 1.0471975511965976, 1);
    break;
  default:
    break;
  }
  line_build();
}

#endif
