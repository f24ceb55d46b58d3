/* modes.h - uniform beams and choices of their modes, shared by the tests of >>modes: natural modes,
   against closed forms and published tables, and against element matrices integrated here in double from the
   polynomials of the shapes. Needs the default capacities or larger ones. */
#ifndef FBT_MODES_H
#define FBT_MODES_H

#include "fbt.h"

#define EPS FBT_TOL(2.2204460492503131e-16, 1.19209290e-7)
#define MAX_DOF (14 * FB_MAX_ELEMENTS + 6)

/* Elements where rounding and truncation balance: in single precision the stiffness of short elements cancels, and the
   first bending frequency of n elements is uncertain by a few 1e-8 n^4. */
#define ELEMENTS FBT_TOL(10, 4)

static const double pi = 3.14159265358979323846;
static fb_beam_desc desc;
static fb_beam beam;
static fb_modes_work work;

/* Length 2, mass 3, EI_y 5, EI_z 7, EA 11, GJ 13, polar inertia 0: bending factors sqrt(EI / (m L^4)). */
static inline void uniform_desc(int n_element, fb_root root)
{
  memset(&desc, 0, sizeof desc);
  desc.length = FB_R(2.0);
  desc.n_element = n_element;
  desc.root = root;
  desc.n_station = 1;
  desc.station[0].mass = FB_R(3.0);
  desc.station[0].EI_y = FB_R(5.0);
  desc.station[0].EI_z = FB_R(7.0);
  desc.station[0].EA = FB_R(11.0);
  desc.station[0].GJ = FB_R(13.0);
}

static inline fb_status solve(fb_modes *out, int bend_y, int bend_z, int axial, int torsion)
{
  static fb_modes_desc keep;
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Y] = bend_y;
  keep.count[FB_KIND_BEND_Z] = bend_z;
  keep.count[FB_KIND_AXIAL] = axial;
  keep.count[FB_KIND_TORSION] = torsion;
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  return fb_modes_solve(out, &work, &beam, &keep);
}

/* Frequency of the k-th mode (from 1) of a kind. */
static inline double omega_of(const fb_modes *in, fb_kind kind, int k)
{
  for (int i = 0; i < in->n; i++) {
    k -= in->kind[i] == kind;
    if (k == 0) {
      return (double)in->omega[i];
    }
  }
  FBT_INT_EQ(k, 0); /* the mode exists */
  return 0.0;
}

/* A desc for fb_modes_solve, and the beam of desc. */
static inline fb_modes_desc *choice(void)
{
  static fb_modes_desc keep;
  memset(&keep, 0, sizeof keep);
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  return &keep;
}

/* The shapes of an element as polynomials in s = 0..1 (E6.1, E6.5): what moves (0 u_x, 1 u_y, 2 u_z, 3 theta_x),
   with which power of the element length and sign (u_z has the slope -theta_y), and the coefficients. */
typedef struct shape_polynomial {
  int component, slope;
  double sign, c[6];
} shape_polynomial;

static const shape_polynomial element[20] = {
    {0, 0, 1, {1, -1, 0, 0, 0, 0}},         {1, 0, 1, {1, 0, -3, 2, 0, 0}},         {2, 0, 1, {1, 0, -3, 2, 0, 0}},
    {3, 0, 1, {1, -1, 0, 0, 0, 0}},         {2, 1, -1, {0, 1, -2, 1, 0, 0}},        {1, 1, 1, {0, 1, -2, 1, 0, 0}},
    {0, 0, 1, {0, 1, 0, 0, 0, 0}},          {1, 0, 1, {0, 0, 3, -2, 0, 0}},         {2, 0, 1, {0, 0, 3, -2, 0, 0}},
    {3, 0, 1, {0, 1, 0, 0, 0, 0}},          {2, 1, -1, {0, 0, -1, 1, 0, 0}},        {1, 1, 1, {0, 0, -1, 1, 0, 0}},
    {1, 0, 1, {0, 0, 16, -32, 16, 0}},      {1, 0, 1, {0, 0, -64, 256, -320, 128}}, {2, 0, 1, {0, 0, 16, -32, 16, 0}},
    {2, 0, 1, {0, 0, -64, 256, -320, 128}}, {0, 0, 1, {0, 4, -4, 0, 0, 0}},         {0, 0, 1, {0, -8, 24, -16, 0, 0}},
    {3, 0, 1, {0, 4, -4, 0, 0, 0}},         {3, 0, 1, {0, -8, 24, -16, 0, 0}}};

/* int over a..b of u^(order) v^(order) (p0 + p1 s + p2 s^2) ds */
static inline double polynomial_integral(const double *u, const double *v, int order, const double *p, double a,
                                         double b)
{
  double sum = 0.0;
  for (int i = order; i < 6; i++) {
    for (int j = order; j < 6; j++) {
      double factor = u[i] * v[j];
      for (int k = 0; k < order; k++) {
        factor *= (i - k) * (j - k);
      }
      for (int k = 0; k < 3; k++) {
        const int power = i + j - 2 * order + k + 1;
        sum += factor * p[k] * (pow(b, power) - pow(a, power)) / power;
      }
    }
  }
  return sum;
}

static double full_K[MAX_DOF * MAX_DOF], full_M[MAX_DOF * MAX_DOF];

static inline int full_dofs(void)
{
  return 14 * desc.n_element + 6;
}

/* Adds element e between its fractions a and b, properties linear from section *s to *t, with the tension c0 + c1 x +
   c2 x^2. */
static inline void full_add_cell(int e, double a, double b, const fb_section *s, const fb_section *t,
                                 const double tension[3])
{
  const int n = full_dofs(), nodes = 6 * (desc.n_element + 1);
  const double l = (double)desc.length / desc.n_element, x0 = (double)s->x, span = (double)t->x - x0;
  const double from[7] = {(double)s->EA,   (double)s->EI_z, (double)s->EI_y, (double)s->GJ,
                          (double)s->mass, (double)s->i_y,  (double)s->i_z};
  const double to[7] = {(double)t->EA,   (double)t->EI_z, (double)t->EI_y, (double)t->GJ,
                        (double)t->mass, (double)t->i_y,  (double)t->i_z};
  const double T[3] = {tension[0] + e * l * (tension[1] + e * l * tension[2]),
                       l * (tension[1] + 2 * e * l * tension[2]), l * l * tension[2]};
  double p[7][3];
  for (int i = 0; i < 7; i++) {
    const double slope = span > 0.0 ? (to[i] - from[i]) / span : 0.0;
    p[i][0] = from[i] + slope * (e * l - x0);
    p[i][1] = slope * l;
    p[i][2] = 0.0;
  }
  for (int i = 0; i < 20; i++) {
    for (int j = 0; j < 20; j++) {
      const shape_polynomial *u = &element[i], *v = &element[j];
      const int at = (i < 12 ? 6 * e + i : nodes + 8 * e + i - 12) * n + (j < 12 ? 6 * e + j : nodes + 8 * e + j - 12);
      const double scale = u->sign * v->sign * pow(l, u->slope + v->slope);
      if (u->component != v->component) {
        continue;
      }
      if (u->component == 1 || u->component == 2) {
        full_K[at] += scale / (l * l * l) * polynomial_integral(u->c, v->c, 2, p[u->component], a, b);
        full_K[at] += scale / l * polynomial_integral(u->c, v->c, 1, T, a, b);
        full_M[at] += scale * l * polynomial_integral(u->c, v->c, 0, p[4], a, b);
        full_M[at] += scale / l * polynomial_integral(u->c, v->c, 1, p[u->component == 1 ? 6 : 5], a, b);
      } else {
        full_K[at] += scale / l * polynomial_integral(u->c, v->c, 1, p[u->component], a, b);
        full_M[at] += u->component == 0 ? scale * l * polynomial_integral(u->c, v->c, 0, p[4], a, b) : 0.0;
        full_M[at] += u->component == 3 ? scale * l * polynomial_integral(u->c, v->c, 0, p[5], a, b) : 0.0;
        full_M[at] += u->component == 3 ? scale * l * polynomial_integral(u->c, v->c, 0, p[6], a, b) : 0.0;
      }
    }
  }
}

/* Kinetic energy (bilinear) of a lumped body whose node moves by unit i and unit j: velocities of its center and
   spins. */
static inline double lump_mass(const fb_lump *lump, int i, int j)
{
  const fb_real *J = lump->inertia;
  const double c[3] = {(double)lump->center[0], (double)lump->center[1], (double)lump->center[2]};
  const double own[9] = {(double)J[0], (double)J[3], (double)J[4], (double)J[3], (double)J[1],
                         (double)J[5], (double)J[4], (double)J[5], (double)J[2]};
  double v[2][3], sum = 0.0;
  for (int side = 0; side < 2; side++) {
    const int k = side ? j : i;
    for (int a = 0; a < 3; a++) { /* e_k x c: component a */
      const int r = k - 3;
      v[side][a] = k < 3 ? a == k : a == (r + 1) % 3 ? -c[(r + 2) % 3] : a == (r + 2) % 3 ? c[(r + 1) % 3] : 0.0;
    }
  }
  for (int a = 0; a < 3; a++) {
    sum += (double)lump->mass * v[0][a] * v[1][a];
  }
  return sum + (i >= 3 && j >= 3 ? own[3 * (i - 3) + j - 3] : 0.0);
}

/* full_K and full_M of desc, all shapes, no root condition. */
static inline void full_matrices(const double tension[3])
{
  const int n = full_dofs();
  memset(full_K, 0, sizeof full_K);
  memset(full_M, 0, sizeof full_M);
  for (int e = 0; e < desc.n_element; e++) {
    const double l = (double)desc.length / desc.n_element;
    if (desc.n_station == 1) {
      full_add_cell(e, 0.0, 1.0, &desc.station[0], &desc.station[0], tension);
    }
    for (int k = 0; k + 1 < desc.n_station; k++) {
      const double a = fmax(0.0, (double)desc.station[k].x / l - e);
      const double b = fmin(1.0, (double)desc.station[k + 1].x / l - e);
      if (a < b) {
        full_add_cell(e, a, b, &desc.station[k], &desc.station[k + 1], tension);
      }
    }
  }
  for (int k = 0; k < desc.n_lump; k++) {
    const int at = 6 * desc.lump[k].node;
    for (int i = 0; i < 36; i++) {
      full_M[(at + i / 6) * n + at + i % 6] += lump_mass(&desc.lump[k], i / 6, i % 6);
    }
  }
}

static inline double form(const double *A, const fb_real *y, const fb_real *z)
{
  const int n = full_dofs();
  double sum = 0.0;
  for (int i = 0; i < n; i++) {
    double row = 0.0;
    for (int j = 0; j < n; j++) {
      row += A[i * n + j] * (double)z[j];
    }
    sum += (double)y[i] * row;
  }
  return sum;
}

/* Five stations, two bodies off the axis: every kind of motion is coupled with every other. */
static inline void coupled_desc(int n_element, fb_root root)
{
  static const fb_lump lump[2] = {{0,
                                   FB_R(1.3),
                                   {FB_R(-0.1), FB_R(0.2), FB_R(0.3)},
                                   {FB_R(0.3), FB_R(0.4), FB_R(0.5), FB_R(-0.1), FB_R(0.05), FB_R(0.08)}},
                                  {0,
                                   FB_R(0.8),
                                   {FB_R(0.1), FB_R(-0.3), FB_R(0.2)},
                                   {FB_R(0.3), FB_R(0.2), FB_R(0.25), FB_R(0.05), FB_R(-0.02), FB_R(0.01)}}};
  uniform_desc(n_element, root);
  desc.n_station = 5;
  for (int k = 4; k >= 0; k--) {
    static const double x[5] = {0.0, 0.26, 1.0, 1.15, 2.0};
    fb_section *s = &desc.station[k];
    *s = desc.station[0];
    s->x = (fb_real)x[k];
    s->mass *= (fb_real)(1.0 + 0.4 * fbt_random());
    s->EA *= (fb_real)(1.0 + 0.4 * fbt_random());
    s->GJ *= (fb_real)(1.0 + 0.4 * fbt_random());
    s->EI_y *= (fb_real)(1.0 + 0.4 * fbt_random());
    s->EI_z *= (fb_real)(1.0 + 0.4 * fbt_random());
    s->i_y = (fb_real)(0.1 + 0.04 * fbt_random());
    s->i_z = (fb_real)(0.1 + 0.04 * fbt_random());
  }
  desc.n_lump = 2;
  desc.lump[0] = lump[0];
  desc.lump[0].node = n_element;
  desc.lump[1] = lump[1];
  desc.lump[1].node = n_element / 2;
}

/* Is this degree of freedom held, by the root condition or because its kind has no stiffness, which means rigid? */
static inline int is_held(int dof)
{
  const fb_section *s = &desc.station[0];
  const fb_real stiffness[4] = {s->EA, s->EI_z, s->EI_y, s->GJ};
  const int nodes = 6 * (desc.n_element + 1);
  const shape_polynomial *p = &element[dof < nodes ? dof % 6 : 12 + (dof - nodes) % 8];
  return (dof < 6 && desc.root != FB_ROOT_FREE && (desc.root == FB_ROOT_CLAMPED || dof < 4)) ||
         !(stiffness[p->component] > FB_R(0.0));
}

static const double no_tension[3] = {0.0, 0.0, 0.0};

/* X M X^T = 1, X K X^T = omega^2, K x = omega^2 M x in every free coordinate (in units of the largest term of the row),
   held coordinates still, tip displacement of the mode's kind positive, ascending. */
static inline void modes_are_right(const fb_modes *in)
{
  static const int main_dof[FB_KIND_COUNT] = {1, 2, 0, 3};
  const int n = full_dofs();
  FBT_INT_EQ(in->ndof, n);
  full_matrices(no_tension);
  for (int a = 0; a < in->n; a++) {
    const fb_real *x = in->shape + a * n;
    const double omega = (double)in->omega[a];
    FBT_TRUE(x[6 * desc.n_element + main_dof[in->kind[a]]] > FB_R(0.0));
    FBT_TRUE(a == 0 || in->omega[a] >= in->omega[a - 1]);
    for (int b = 0; b < in->n; b++) {
      const fb_real *y = in->shape + b * n;
      const double k = form(full_K, x, y) / (omega * (double)in->omega[b]);
      FBT_NEAR_ABS(form(full_M, x, y), a == b, FBT_TOL(2e-13, 5e-6));
      FBT_NEAR_ABS(k, a == b, FBT_TOL(1e-12, 1e-4));
      FBT_NEAR_ABS(in->M[a * in->n + b], a == b, 0.0);
      FBT_NEAR_REL(in->K[a * in->n + b], a == b ? omega * omega : 0.0, 4.0 * EPS);
    }
    for (int i = 0; i < n; i++) {
      double residual = 0.0, size = 0.0;
      for (int j = 0; j < n; j++) {
        const double k = full_K[i * n + j] * (double)x[j], m = omega * omega * full_M[i * n + j] * (double)x[j];
        residual += k - m;
        size += fabs(k) + fabs(m);
      }
      if (is_held(i)) {
        FBT_TRUE(x[i] >= FB_R(0.0) && x[i] <= FB_R(0.0));
      } else {
        FBT_NEAR_ABS(residual, 0.0, FBT_TOL(1e-9, 3e-3) * size);
      }
    }
  }
}

#endif
