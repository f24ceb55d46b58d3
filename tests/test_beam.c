/* >>beam: sections, stations, lumped bodies, element matrices. References are written out in double or summed in
   long double from the very numbers of the desc; bounds are units of the epsilon of fb_real. */
#include "fbt.h"

#define EPS FBT_TOL(2.2204460492503131e-16, 1.19209290e-7)
#define MAX_DOF (6 * (FB_MAX_ELEMENTS + 1))

static fb_beam_desc desc;
static fb_beam beam;
static fb_real K[MAX_DOF * MAX_DOF], M[MAX_DOF * MAX_DOF];

static void uniform_desc(fb_beam_desc *out, int n_element)
{
  memset(out, 0, sizeof *out);
  out->length = FB_R(1.7);
  out->n_element = n_element;
  out->n_station = 1;
  out->station[0].mass = FB_R(2.3);
  out->station[0].EA = FB_R(7.1);
  out->station[0].GJ = FB_R(3.7);
  out->station[0].EI_y = FB_R(5.3);
  out->station[0].EI_z = FB_R(1.9);
  out->station[0].i_y = FB_R(0.13);
  out->station[0].i_z = FB_R(0.29);
}

/* Five stations, none on a node of most meshes, the middle one on the node of an even number of elements. */
static void tapered_desc(fb_beam_desc *out, int n_element)
{
  static const double x[5] = {0.0, 0.13, 0.5, 0.58, 1.0};
  uniform_desc(out, n_element);
  out->n_station = 5;
  for (int k = 0; k < 5; k++) {
    fb_section *s = &out->station[k];
    s->x = k == 4 ? out->length : (fb_real)x[k] * out->length;
    s->mass = (fb_real)(2.0 + fbt_random());
    s->EA = (fb_real)(2.0 + fbt_random());
    s->GJ = (fb_real)(2.0 + fbt_random());
    s->EI_y = (fb_real)(2.0 + fbt_random());
    s->EI_z = (fb_real)(2.0 + fbt_random());
    s->i_y = (fb_real)(0.2 + 0.1 * fbt_random());
    s->i_z = (fb_real)(0.2 + 0.1 * fbt_random());
  }
}

/* Two bodies off the axis with full inertia matrices. */
static void lumps_add(fb_beam_desc *out)
{
  static const fb_lump lump[2] = {{0,
                                   FB_R(0.7),
                                   {FB_R(0.1), FB_R(-0.3), FB_R(0.2)},
                                   {FB_R(0.5), FB_R(0.6), FB_R(0.7), FB_R(0.1), FB_R(-0.05), FB_R(0.08)}},
                                  {1,
                                   FB_R(1.3),
                                   {FB_R(-0.2), FB_R(0.4), FB_R(0.5)},
                                   {FB_R(0.9), FB_R(0.8), FB_R(0.6), FB_R(-0.2), FB_R(0.1), FB_R(0.15)}}};
  out->n_lump = 2;
  out->lump[0] = lump[0];
  out->lump[1] = lump[1];
  out->lump[1].node = out->n_element;
}

/* Adds one plane's bending matrices (12 x 12) at displacement u and rotation t of the first node: sign = 1 where the
   rotation is +u', -1 where it is -u'; p = 12 EI / (GA l^2), 0 without shear. */
static void textbook_bending(double *Kt, double *Mt, int u, int t, double sign, double EI, double m, double i, double l,
                             double p)
{
  const int at[4] = {u, t, u + 6, t + 6};
  const double d = 4.0 + p, o = 2.0 - p, q = (1.0 + p) * (1.0 + p);
  const double k[16] = {12,  6 * l,  -12, 6 * l,  6 * l, d * l * l, -6 * l, o * l * l,
                        -12, -6 * l, 12,  -6 * l, 6 * l, o * l * l, -6 * l, d * l * l};
  const double c0 = 156 + 294 * p + 140 * p * p, c1 = 22 + 38.5 * p + 17.5 * p * p, c2 = 54 + 126 * p + 70 * p * p;
  const double c3 = 13 + 31.5 * p + 17.5 * p * p, c4 = 4 + 7 * p + 3.5 * p * p, c5 = 3 + 7 * p + 3.5 * p * p;
  const double c[16] = {c0, c1 * l, c2, -c3 * l, c1 * l,  c4 * l * l,  c3 * l,  -c5 * l * l,
                        c2, c3 * l, c0, -c1 * l, -c3 * l, -c5 * l * l, -c1 * l, c4 * l * l};
  const double r1 = 3 - 15 * p, r2 = 4 + 5 * p + 10 * p * p, r3 = -1 - 5 * p + 5 * p * p;
  const double r[16] = {36,  r1 * l,  -36, r1 * l,  r1 * l, r2 * l * l, -r1 * l, r3 * l * l,
                        -36, -r1 * l, 36,  -r1 * l, r1 * l, r3 * l * l, -r1 * l, r2 * l * l};
  for (int a = 0; a < 4; a++) {
    for (int b = 0; b < 4; b++) {
      const double s = (a + b) % 2 ? sign : 1.0;
      Kt[12 * at[a] + at[b]] += s * EI / (l * l * l * (1.0 + p)) * k[4 * a + b];
      Mt[12 * at[a] + at[b]] += s * (m * l / 420.0 * c[4 * a + b] + i / (30.0 * l) * r[4 * a + b]) / q;
    }
  }
}

static void textbook_rod(double *Kt, double *Mt, int u, double stiffness, double m, double l)
{
  for (int a = 0; a < 2; a++) {
    for (int b = 0; b < 2; b++) {
      Kt[12 * (u + 6 * a) + u + 6 * b] += (a == b ? 1.0 : -1.0) * stiffness / l;
      Mt[12 * (u + 6 * a) + u + 6 * b] += (a == b ? 2.0 : 1.0) * m * l / 6.0;
    }
  }
}

/* E6.3, E6.1, E6.13: Przemieniecki, Theory of Matrix Structural Analysis, 1968, 5.6 and 11.4, without and with shear;
   both planes with the signs of theta_z = u_y' and theta_y = -u_z'; three elements are three times one. */
TEST(element_matrices_match_the_textbook_ones)
{
  for (int mesh = 0; mesh < 4; mesh++) {
    const int n = mesh % 2 ? 3 : 1, ndof = 6 * (n + 1);
    double Kt[144] = {0}, Mt[144] = {0};
    const fb_section *s = desc.station;
    double l, p_y = 0.0, p_z = 0.0;
    uniform_desc(&desc, n);
    l = (double)desc.length / n;
    if (mesh >= 2) {
      desc.station[0].GA_y = FB_R(17.0);
      desc.station[0].GA_z = FB_R(60.0);
      p_y = 12.0 * (double)s->EI_z / (17.0 * l * l);
      p_z = 12.0 * (double)s->EI_y / (60.0 * l * l);
    }
    textbook_bending(Kt, Mt, 1, 5, 1.0, (double)s->EI_z, (double)s->mass, (double)s->i_z, l, p_y);
    textbook_bending(Kt, Mt, 2, 4, -1.0, (double)s->EI_y, (double)s->mass, (double)s->i_y, l, p_z);
    textbook_rod(Kt, Mt, 0, (double)s->EA, (double)s->mass, l);
    textbook_rod(Kt, Mt, 3, (double)s->GJ, (double)s->i_y + (double)s->i_z, l);
    FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
    fbt_fill(K, MAX_DOF * MAX_DOF, 1e9);
    fbt_fill(M, MAX_DOF * MAX_DOF, 1e9);
    fb_beam_matrices_eval(&beam, K, M);
    for (int i = 0; i < ndof; i++) {
      for (int j = 0; j < ndof; j++) {
        double k = 0.0, m = 0.0;
        for (int e = 0; e < n; e++) {
          const int a = i - 6 * e, b = j - 6 * e;
          k += a >= 0 && a < 12 && b >= 0 && b < 12 ? Kt[12 * a + b] : 0.0;
          m += a >= 0 && a < 12 && b >= 0 && b < 12 ? Mt[12 * a + b] : 0.0;
        }
        const double rounding = (mesh >= 2 ? 64.0 : 4.0) * n * EPS;
        FBT_NEAR_ABS(K[i * ndof + j], k, rounding * sqrt(Kt[13 * (i % 6)] * Kt[13 * (j % 6)]));
        FBT_NEAR_ABS(M[i * ndof + j], m, rounding * sqrt(Mt[13 * (i % 6)] * Mt[13 * (j % 6)]));
      }
    }
  }
}

enum { MASS, EA, GJ, EI_Y, EI_Z, I_Y, I_Z };

/* int_0^length p(x) x^power dx of the piecewise linear property p, term by term. */
static double moment(int property, int power)
{
  long double sum = 0.0L;
  for (int k = 0; k + 1 < desc.n_station; k++) {
    const fb_section *s = &desc.station[k], *e = s + 1;
    const fb_real value[2][7] = {{s->mass, s->EA, s->GJ, s->EI_y, s->EI_z, s->i_y, s->i_z},
                                 {e->mass, e->EA, e->GJ, e->EI_y, e->EI_z, e->i_y, e->i_z}};
    const long double x0 = (long double)s->x, x1 = (long double)e->x, p0 = (long double)value[0][property];
    const long double slope = ((long double)value[1][property] - p0) / (x1 - x0);
    sum += (p0 - slope * x0) * (powl(x1, power + 1) - powl(x0, power + 1)) / (power + 1);
    sum += slope * (powl(x1, power + 2) - powl(x0, power + 2)) / (power + 2);
  }
  return (double)sum;
}

/* y^T A z and the sum of the magnitudes of its terms. */
static double form(double *size, const fb_real *matrix, const double *y, const double *z, int n)
{
  long double sum = 0.0L, all = 0.0L;
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) {
      const long double t = (long double)y[i] * (long double)matrix[i * n + j] * (long double)z[j];
      sum += t;
      all += fabsl(t);
    }
  }
  *size = (double)all;
  return (double)sum;
}

/* Rigid translation (axis 0 to 2) or rotation about the root (3 to 5) in nodal values. */
static void rigid_field(double *y, int axis)
{
  for (int node = 0; node <= desc.n_element; node++) {
    double *at = y + 6 * node;
    const double x = (double)desc.length * node / desc.n_element;
    memset(at, 0, 6 * sizeof *at);
    at[axis] = 1.0;
    at[2] -= axis == 4 ? x : 0.0; /* e_y x (x, 0, 0) = (0, 0, -x) */
    at[1] += axis == 5 ? x : 0.0;
  }
}

/* Mass matrix of the beam as a rigid body about the root: [m, -mc^; mc^, J]. */
static void rigid_mass(double R[36])
{
  double c[3] = {moment(MASS, 1), 0.0, 0.0}, J[9] = {0}, m = moment(MASS, 0);
  J[0] = moment(I_Y, 0) + moment(I_Z, 0);
  J[4] = moment(MASS, 2) + moment(I_Y, 0);
  J[8] = moment(MASS, 2) + moment(I_Z, 0);
  for (int k = 0; k < desc.n_lump; k++) {
    const fb_lump *lump = &desc.lump[k];
    const fb_real *I6 = lump->inertia;
    const double own[9] = {(double)I6[0], (double)I6[3], (double)I6[4], (double)I6[3], (double)I6[1],
                           (double)I6[5], (double)I6[4], (double)I6[5], (double)I6[2]};
    const double r[3] = {(double)desc.length * lump->node / desc.n_element + (double)lump->center[0],
                         (double)lump->center[1], (double)lump->center[2]};
    m += (double)lump->mass;
    for (int i = 0; i < 3; i++) {
      c[i] += (double)lump->mass * r[i];
      for (int j = 0; j < 3; j++) {
        J[3 * i + j] += own[3 * i + j] +
                        (double)lump->mass * ((i == j ? r[0] * r[0] + r[1] * r[1] + r[2] * r[2] : 0.0) - r[i] * r[j]);
      }
    }
  }
  memset(R, 0, 36 * sizeof *R);
  for (int i = 0; i < 3; i++) {
    R[7 * i] = m;
    for (int j = 0; j < 3; j++) {
      R[6 * (3 + i) + 3 + j] = J[3 * i + j];
    }
  }
  R[4] = R[24] = c[2]; /* (v x) . (w_y x c) and so on */
  R[5] = R[30] = -c[1];
  R[9] = R[19] = -c[2];
  R[11] = R[31] = c[0];
  R[15] = R[20] = c[1];
  R[16] = R[26] = -c[0];
}

/* E6.1, E6.4: the six rigid motions cost no strain energy in any element, and their kinetic energy is that of the rigid
   body: mass, first and second moments with the rotary inertia of the sections and lumped bodies off the axis. */
TEST(rigid_motion_of_an_element_gives_no_strain)
{
  static const int mesh[] = {1, 2, 3, 7, FB_MAX_ELEMENTS};
  for (int k = 0; k < FBT_COUNT(mesh); k++) {
    const int n = 6 * (mesh[k] + 1);
    double y[6][MAX_DOF], R[36];
    tapered_desc(&desc, mesh[k]);
    lumps_add(&desc);
    FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
    fb_beam_matrices_eval(&beam, K, M);
    rigid_mass(R);
    FBT_NEAR_REL(beam.mass, R[0], 4.0 * EPS);
    for (int a = 0; a < 6; a++) {
      rigid_field(y[a], a);
      for (int i = 0; i < n; i++) {
        double force = 0.0, size = 0.0;
        for (int j = 0; j < n; j++) {
          force += (double)K[i * n + j] * y[a][j];
          size += fabs((double)K[i * n + j] * y[a][j]);
        }
        FBT_NEAR_ABS(force, 0.0, 4.0 * EPS * size);
      }
    }
    for (int a = 0; a < 6; a++) {
      for (int b = 0; b < 6; b++) {
        double size;
        const double got = form(&size, M, y[a], y[b], n);
        FBT_NEAR_ABS(got, R[6 * a + b], 4.0 * EPS * size);
      }
    }
  }
}

/* The field x^power in the nodal values of a kind: 0 u_x, 1 u_y, 2 u_z, 3 theta_x. */
static void power_field(double *y, int kind, int power)
{
  memset(y, 0, MAX_DOF * sizeof *y);
  for (int node = 0; node <= desc.n_element; node++) {
    const double x = (double)desc.length * node / desc.n_element;
    const double slope = power ? power * pow(x, power - 1) : 0.0;
    y[6 * node + kind] = pow(x, power);
    if (kind == 1) {
      y[6 * node + 5] = slope;
    } else if (kind == 2) {
      y[6 * node + 4] = -slope;
    }
  }
}

/* Strain and kinetic energies (bilinear) of the fields x^p and x^q of a kind. */
static void power_energies(double *strain, double *kinetic, int kind, int p, int q)
{
  const int stiffness = kind == 0 ? EA : kind == 1 ? EI_Z : kind == 2 ? EI_Y : GJ;
  const int rotary = kind == 1 ? I_Z : I_Y;
  const int order = kind == 1 || kind == 2 ? 2 : 1;
  const int factor = order == 2 ? p * (p - 1) * q * (q - 1) : p * q;
  *strain = factor ? factor * moment(stiffness, p + q - 2 * order) : 0.0;
  *kinetic = kind == 3 ? moment(I_Y, p + q) + moment(I_Z, p + q) : moment(MASS, p + q);
  if (order == 2 && p > 0 && q > 0) {
    *kinetic += p * q * moment(rotary, p + q - 2);
  }
}

/* E6.3: with stations inside elements the energies of every polynomial field the elements hold, cubic bending, linear
   extension and twist, are the integrals of the piecewise linear table, whatever the mesh. */
TEST(tapered_stations_integrate_exactly)
{
  for (int mesh = 1; mesh <= FB_MAX_ELEMENTS; mesh++) {
    const int n = 6 * (mesh + 1);
    fbt_seed(1);
    tapered_desc(&desc, mesh);
    FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
    fb_beam_matrices_eval(&beam, K, M);
    FBT_NEAR_REL(beam.mass, moment(MASS, 0), 4.0 * EPS);
    for (int kind = 0; kind < 4; kind++) {
      const int degree = kind == 1 || kind == 2 ? 3 : 1;
      for (int p = 0; p <= degree; p++) {
        for (int q = 0; q <= degree; q++) {
          double y[MAX_DOF], z[MAX_DOF], strain, kinetic, size;
          power_field(y, kind, p);
          power_field(z, kind, q);
          power_energies(&strain, &kinetic, kind, p, q);
          {
            const double got = form(&size, K, y, z, n);
            FBT_NEAR_ABS(got, strain, 4.0 * EPS * size);
          }
          {
            const double got = form(&size, M, y, z, n);
            FBT_NEAR_ABS(got, kinetic, 4.0 * EPS * size);
          }
        }
      }
    }
  }
}

/* E6.15: properties are linear between stations and keep the end values outside. */
TEST(sections_are_interpolated_between_stations)
{
  fb_section s;
  tapered_desc(&desc, 3);
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  for (int k = 0; k < desc.n_station; k++) {
    const fb_section *a = &desc.station[k], *b = a + (k + 1 < desc.n_station);
    for (int i = 0; i <= 4; i++) {
      const double t = 0.25 * i, x = (double)a->x + t * ((double)b->x - (double)a->x);
      fb_beam_section_eval(&beam, &s, (fb_real)x);
      FBT_NEAR_ABS(s.x, x, 2.0 * EPS);
      FBT_NEAR_REL(s.mass, (1.0 - t) * (double)a->mass + t * (double)b->mass, 16.0 * EPS);
      FBT_NEAR_REL(s.EA, (1.0 - t) * (double)a->EA + t * (double)b->EA, 16.0 * EPS);
      FBT_NEAR_REL(s.GJ, (1.0 - t) * (double)a->GJ + t * (double)b->GJ, 16.0 * EPS);
      FBT_NEAR_REL(s.EI_y, (1.0 - t) * (double)a->EI_y + t * (double)b->EI_y, 16.0 * EPS);
      FBT_NEAR_REL(s.EI_z, (1.0 - t) * (double)a->EI_z + t * (double)b->EI_z, 16.0 * EPS);
      FBT_NEAR_REL(s.i_y, (1.0 - t) * (double)a->i_y + t * (double)b->i_y, 16.0 * EPS);
      FBT_NEAR_REL(s.i_z, (1.0 - t) * (double)a->i_z + t * (double)b->i_z, 16.0 * EPS);
    }
  }
  fb_beam_section_eval(&beam, &s, -FB_R(1.0));
  FBT_NEAR_ABS(s.EI_z, desc.station[0].EI_z, 0.0);
  fb_beam_section_eval(&beam, &s, FB_R(2.0) * desc.length);
  FBT_NEAR_ABS(s.EI_z, desc.station[4].EI_z, 0.0);
  uniform_desc(&desc, 3);
  desc.station[0].x = FB_R(77.0); /* one station: its place is ignored */
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  FBT_NEAR_ABS(beam.desc.station[0].x, 0.0, 0.0);
  FBT_NEAR_REL(beam.mass, (double)desc.length * (double)desc.station[0].mass, 4.0 * EPS);
  for (int i = 0; i <= 4; i++) {
    fb_beam_section_eval(&beam, &s, FB_R(0.25) * (fb_real)i * desc.length);
    FBT_NEAR_ABS(s.mass, desc.station[0].mass, 0.0);
  }
}

static fb_beam pattern; /* what must survive a refusal */

/* desc is refused with the status and the beam keeps every byte. */
static void refused(fb_status expected)
{
  memset(&pattern, 0xA5, sizeof pattern);
  memset(&beam, 0xA5, sizeof beam);
  FBT_INT_EQ(fb_beam_init(&beam, &desc), expected);
  FBT_TRUE(memcmp(&beam, &pattern, sizeof beam) == 0);
}

/* Inertia about the mass center (xx, yy, zz, xy, xz, yz) of n random particles, rounded once. */
static void particles_inertia(fb_real inertia[6], int n)
{
  double S[6] = {0}, sum[3] = {0}, r[8][3]; /* int xx, yy, zz, xy, xz, yz */
  for (int p = 0; p < n; p++) {
    for (int k = 0; k < 3; k++) {
      r[p][k] = fbt_random();
      sum[k] += r[p][k] / n;
    }
  }
  for (int p = 0; p < n; p++) {
    const double x = r[p][0] - sum[0], y = r[p][1] - sum[1], z = r[p][2] - sum[2];
    const double add[6] = {x * x, y * y, z * z, x * y, x * z, y * z};
    for (int k = 0; k < 6; k++) {
      S[k] += add[k];
    }
  }
  inertia[0] = (fb_real)(S[1] + S[2]);
  inertia[1] = (fb_real)(S[0] + S[2]);
  inertia[2] = (fb_real)(S[0] + S[1]);
  inertia[3] = (fb_real)-S[3];
  inertia[4] = (fb_real)-S[4];
  inertia[5] = (fb_real)-S[5];
}

/* J = R diag(a) R^T for a random rotation R. */
static void principal_inertia(fb_real inertia[6], double a, double b, double c)
{
  static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
  const double principal[3] = {a, b, c};
  fb_real q[4], R[9];
  fbt_fill(q, 4, 1.0);
  FBT_INT_EQ(fb_quat_normalize(q), FB_OK);
  fb_quat_to_mat33(R, q);
  for (int k = 0; k < 6; k++) {
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
      sum += (double)R[3 * row[k] + i] * principal[i] * (double)R[3 * column[k] + i];
    }
    inertia[k] = (fb_real)sum;
  }
}

/* E6.2: an inertia is that of a distribution of positive mass if and only if int r r^T dm is semidefinite: principal
   moments obey the triangle inequality, in any axes. Rods and plates, where it holds with equality, are accepted. */
TEST(lumped_bodies_must_have_a_physical_inertia)
{
  static const fb_real good[][6] = {{0, 0, 0, 0, 0, 0}, {1, 1, 1, 0, 0, 0}, {0, 1, 1, 0, 0, 0},  {1, 0, 1, 0, 0, 0},
                                    {1, 1, 0, 0, 0, 0}, {2, 1, 1, 0, 0, 0}, {1, 2, 1, 0, 0, 0},  {1, 1, 2, 0, 0, 0},
                                    {1, 1, 2, 1, 0, 0}, {1, 2, 1, 0, 1, 0}, {2, 1, 1, 0, 0, -1}, {2, 2, 2, 1, 1, -1}};
  static const fb_real bad[][6] = {{3, 1, 1, 0, 0, 0},    {1, 3, 1, 0, 0, 0},     {1, 1, 3, 0, 0, 0},
                                   {-1, 1, 1, 0, 0, 0},   {1, 0, 0, 0, 0, 0},     {0, 0, 1, 0, 0, 0},
                                   {0, 0, 0, 1, 0, 0},    {0, 0, 0, 0, 0, -1},    {0, 1, 1, 1, 0, 0},
                                   {1, 1, 1, 0.75, 0, 0}, {1, 1, 1, 0, -0.75, 0}, {1, 1, 1, 0, 0, 0.75},
                                   {2, 1, 1, 0.25, 0, 0}, {1, 1, 2, 0, 0.25, 0},  {-1, -1, -1, 0, 0, 0}};
  uniform_desc(&desc, 2);
  desc.n_lump = 1;
  desc.lump[0].mass = FB_R(1.0);
  desc.lump[0].node = 2;
  for (int k = 0; k < FBT_COUNT(good); k++) {
    for (int scale = -24; scale <= 24; scale += 24) { /* the verdict has no unit */
      for (int i = 0; i < 6; i++) {
        desc.lump[0].inertia[i] = (fb_real)ldexp((double)good[k][i], scale);
      }
      FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
    }
  }
  for (int k = 0; k < FBT_COUNT(bad); k++) {
    for (int scale = -24; scale <= 24; scale += 24) {
      for (int i = 0; i < 6; i++) {
        desc.lump[0].inertia[i] = (fb_real)ldexp((double)bad[k][i], scale);
      }
      refused(FB_ERR_VALUE);
    }
  }
  for (int trial = 0; trial < 200; trial++) {
    particles_inertia(desc.lump[0].inertia, 5 + trial % 4);
    FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
    principal_inertia(desc.lump[0].inertia, 1.0, 1.5, 2.5 * (1.0 - 64.0 * EPS));
    FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
    principal_inertia(desc.lump[0].inertia, 1.0, 1.5, 2.501);
    refused(FB_ERR_VALUE);
    principal_inertia(desc.lump[0].inertia, -0.001, 1.0, 1.0);
    refused(FB_ERR_VALUE);
  }
}

/* One fault each; the status it deserves, or FB_OK after the last. */
static fb_status spoil(int fault)
{
  fb_section *middle = &desc.station[2], *last = &desc.station[4];
  switch (fault) {
  case 0:
    desc.length = FB_R(0.0);
    return FB_ERR_VALUE;
  case 1:
    desc.length = -desc.length;
    return FB_ERR_VALUE;
  case 2:
    desc.n_element = 0;
    return FB_ERR_VALUE;
  case 3:
    desc.n_element = -1;
    return FB_ERR_VALUE;
  case 4:
    desc.n_element = FB_MAX_ELEMENTS + 1;
    return FB_ERR_CAPACITY;
  case 5:
    desc.n_station = 0;
    return FB_ERR_VALUE;
  case 6:
    desc.n_station = -1;
    return FB_ERR_VALUE;
  case 7:
    desc.n_station = FB_MAX_STATIONS + 1;
    return FB_ERR_CAPACITY;
  case 8:
    desc.n_lump = -1;
    return FB_ERR_VALUE;
  case 9:
    desc.n_lump = FB_MAX_LUMPS + 1;
    return FB_ERR_CAPACITY;
  case 10:
    desc.root = FB_ROOT_COUNT;
    return FB_ERR_VALUE;
  case 11:
    middle->x = desc.station[1].x; /* not ascending */
    return FB_ERR_VALUE;
  case 12:
    middle->x = -middle->x;
    return FB_ERR_VALUE;
  case 13:
    desc.station[0].x = FB_R(1e-3); /* not from the root */
    return FB_ERR_VALUE;
  case 14:
    desc.station[0].x = -FB_R(1e-3);
    return FB_ERR_VALUE;
  case 15:
    last->x *= FB_R(0.999); /* not to the tip */
    return FB_ERR_VALUE;
  case 16:
    last->x *= FB_R(1.001);
    return FB_ERR_VALUE;
  case 17:
    middle->mass = -FB_R(1e-6);
    return FB_ERR_VALUE;
  case 18:
    middle->EA = -FB_R(1e-6);
    return FB_ERR_VALUE;
  case 19:
    middle->GJ = -FB_R(1e-6);
    return FB_ERR_VALUE;
  case 20:
    middle->EI_y = -FB_R(1e-6);
    return FB_ERR_VALUE;
  case 21:
    middle->EI_z = -FB_R(1e-6);
    return FB_ERR_VALUE;
  case 22:
    middle->i_y = -FB_R(1e-6);
    return FB_ERR_VALUE;
  case 23:
    last->i_z = -FB_R(1e-6);
    return FB_ERR_VALUE;
  case 24:
    desc.lump[1].mass = -FB_R(1e-6);
    return FB_ERR_VALUE;
  case 25:
    desc.lump[1].node = desc.n_element + 1;
    return FB_ERR_CAPACITY;
  case 26:
    desc.lump[1].node = -1;
    return FB_ERR_CAPACITY;
  case 27:
    desc.station[1].GA_y = FB_R(1.0); /* shear at one station, along one axis */
    return FB_ERR_VALUE;
  case 28:
    middle->GA_y = middle->GA_z = FB_R(1.0); /* at one station */
    return FB_ERR_VALUE;
  case 29:
    middle->GA_z = -FB_R(1e-6);
    return FB_ERR_VALUE;
  case 30:
    middle->shear_z = FB_R(0.1); /* rigid in shear about another axis */
    return FB_ERR_VALUE;
  case 31:
    middle->twist = FB_R(0.1); /* rigid about an axis that turns */
    middle->EI_y = FB_R(0.0);
    return FB_ERR_VALUE;
  case 32:
    desc.n_point = desc.n_element; /* one too few */
    return FB_ERR_VALUE;
  case 33:
    desc.n_point = FB_MAX_ELEMENTS + 2;
    return FB_ERR_CAPACITY;
  case 34:
    desc.n_point = -1;
    return FB_ERR_VALUE;
  case 35:
  case 36:
  case 37:
    desc.n_point = 4;
    memset(desc.point, 0, sizeof desc.point);
    for (int k = 1; k < 4; k++) {
      desc.point[k][0] = desc.length * (fb_real)k / FB_R(3.0);
    }
    if (fault == 35) {
      desc.point[2][0] = desc.point[1][0]; /* no length */
    } else if (fault == 36) {
      desc.point[0][1] = FB_R(1e-9); /* not from the root */
    } else {
      desc.point[3][0] = desc.point[1][0]; /* turns back */
    }
    return FB_ERR_VALUE;
  case 38:
    for (int k = 0; k < desc.n_station; k++) {
      desc.station[k].mass = FB_R(0.0);
    }
    desc.lump[0].mass = desc.lump[1].mass = FB_R(0.0); /* no mass at all */
    return FB_ERR_VALUE;
  default:
    return FB_OK;
  }
}

/* Every number of the desc that can be not finite. */
static int numbers_of_desc(fb_real *list[128])
{
  int n = 0;
  list[n++] = &desc.length;
  for (int i = 0; i < 3; i++) {
    list[n++] = &desc.position[i];
  }
  for (int i = 0; i < 4; i++) {
    list[n++] = &desc.attitude[i];
  }
  for (int k = 0; k < desc.n_station; k += 2) {
    fb_section *s = &desc.station[k];
    fb_real *all[17] = {&s->x,      &s->mass,      &s->EA,        &s->GJ,      &s->EI_y,   &s->EI_z,
                        &s->i_y,    &s->i_z,       &s->GA_y,      &s->GA_z,    &s->twist,  &s->mass_y,
                        &s->mass_z, &s->tension_y, &s->tension_z, &s->shear_y, &s->shear_z};
    for (int i = 0; i < 17; i++) {
      list[n++] = all[i];
    }
  }
  for (int k = 0; k < desc.n_lump; k++) {
    list[n++] = &desc.lump[k].mass;
    for (int i = 0; i < 9; i++) {
      list[n++] = i < 3 ? &desc.lump[k].center[i] : &desc.lump[k].inertia[i - 3];
    }
  }
  return n;
}

/* Interface: whatever is wrong with a desc is refused with its status, and the beam is not written. */
TEST(bad_beams_are_refused_and_leave_the_output_alone)
{
  const fb_real bad[4] = {(fb_real)NAN, (fb_real)INFINITY, -(fb_real)INFINITY, (fb_real)(4.0 * (double)FB_HUGE)};
  fb_real *list[128];
  int n, faults = 0;
  for (int fault = 0;; fault++) {
    fb_status expected;
    tapered_desc(&desc, 3);
    lumps_add(&desc);
    expected = spoil(fault);
    if (expected == FB_OK) {
      FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
      break;
    }
    refused(expected);
    faults++;
  }
  FBT_INT_EQ(faults, 39);
  n = numbers_of_desc(list);
  for (int i = 0; i < n; i++) {
    for (int k = 0; k < 4; k++) {
      tapered_desc(&desc, 3);
      lumps_add(&desc);
      *list[i] = bad[k];
      refused(FB_ERR_NOT_FINITE);
    }
  }
  tapered_desc(&desc, 3);
  FBT_INT_EQ(fb_beam_init(NULL, &desc), FB_ERR_NULL);
  memset(&beam, 0xA5, sizeof beam);
  FBT_INT_EQ(fb_beam_init(&beam, NULL), FB_ERR_NULL);
  FBT_TRUE(memcmp(&beam, &pattern, sizeof beam) == 0);
}

/* E6.16: axes turned by right angles, one after the other, are exactly those of the body, in another order and
   direction: no element is the round-off of a sine. Axes at another angle keep what is theirs. */
TEST(right_angles_leave_no_round_off)
{
  const double pi = 3.14159265358979324;
  uniform_desc(&desc, 2);
  for (int turns = 0; turns < 64; turns++) {
    fb_real quat[4] = {FB_R(1.0), FB_R(0.0), FB_R(0.0), FB_R(0.0)}, R[9];
    int whole = 0;
    for (int axis = 0; axis < 3; axis++) {
      const fb_real before[4] = {quat[0], quat[1], quat[2], quat[3]};
      fb_real turn[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)}, by[4];
      turn[axis] = (fb_real)(pi / 2 * (turns >> 2 * axis & 3));
      fb_quat_from_rotvec(by, turn);
      fb_quat_mul(quat, before, by);
    }
    memcpy(desc.attitude, quat, sizeof quat);
    FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
    fb_quat_to_mat33(R, quat);
    FBT_BELOW(fbt_difference(beam.axes, R, 9), 4.0 * EPS);
    for (int i = 0; i < 9; i++) {
      const double size = fabs((double)beam.axes[i]);
      whole += !(size > 0) || !(size < 1 || size > 1);
    }
    FBT_TRUE(whole == 9 || R[0] + R[4] + R[8] > FB_R(2.5)); /* small angles stay, those of turns that cancel, too */
  }
  memset(desc.attitude, 0, sizeof desc.attitude);
  desc.attitude[0] = FB_R(1.0);
  desc.attitude[3] = FB_R(16.0) * FB_EPSILON;
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  FBT_NEAR_REL(beam.axes[3], 32.0 * EPS, 1e-3);
}

/* Interface: the largest desc is accepted; a beam without mass of its own may carry bodies; the attitude is normalized,
   and all zero means none. */
TEST(good_beams_keep_their_desc)
{
  fb_real q[4] = {FB_R(1.0), FB_R(2.0), FB_R(-3.0), FB_R(0.5)}, axes[9];
  uniform_desc(&desc, FB_MAX_ELEMENTS);
  desc.n_station = FB_MAX_STATIONS;
  for (int k = 0; k < FB_MAX_STATIONS; k++) {
    desc.station[k] = desc.station[0];
    desc.station[k].x = desc.length * (fb_real)k / (fb_real)(FB_MAX_STATIONS - 1);
  }
  desc.n_lump = FB_MAX_LUMPS;
  for (int k = 0; k < FB_MAX_LUMPS; k++) {
    desc.lump[k].mass = FB_R(0.5);
  }
  memcpy(desc.attitude, q, sizeof q);
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  FBT_TRUE(memcmp(&beam.desc, &desc, sizeof desc) == 0);
  FBT_NEAR_REL(beam.mass, 1.7 * 2.3 + 0.5 * FB_MAX_LUMPS, 16.0 * EPS);
  FBT_INT_EQ(fb_quat_normalize(q), FB_OK);
  fb_quat_to_mat33(axes, q);
  FBT_TRUE(memcmp(beam.axes, axes, sizeof axes) == 0);
  for (int k = 0; k < 16; k++) { /* any element of the attitude may be the only one, or cancel in a sum */
    for (int i = 0; i < 4; i++) {
      desc.attitude[i] = q[i] = (fb_real)((i == k / 4) - (i == k % 4 && k / 4 != k % 4));
    }
    FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
    fb_quat_to_mat33(axes, q);
    FBT_BELOW(fbt_difference(beam.axes, axes, 9), 4.0 * EPS);
  }
  memset(desc.attitude, 0, sizeof desc.attitude);
  for (int k = 0; k < FB_MAX_STATIONS; k++) {
    desc.station[k].mass = FB_R(0.0);
  }
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  FBT_NEAR_REL(beam.mass, 0.5 * FB_MAX_LUMPS, 4.0 * EPS);
  for (int i = 0; i < 9; i++) {
    FBT_NEAR_ABS(beam.axes[i], i % 4 == 0, 0.0);
  }
  desc.n_lump = 1;
  desc.lump[0].mass = FB_R(1e-15); /* however small */
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  FBT_NEAR_REL(beam.mass, 1e-15, 4.0 * EPS);
}

/* J/(a b^3) of a rectangle whose longer side a is ratio b: the series of Timoshenko and Goodier 109. */
static double torsion_factor(double ratio)
{
  double sum = 0.0;
  for (int k = 1999; k > 0; k -= 2) {
    sum += tanh(0.5 * k * 3.14159265358979324 * ratio) / pow(k, 5.0);
  }
  return 1.0 / 3.0 - 64.0 / pow(3.14159265358979324, 5.0) * sum / ratio;
}

/* E6.10: Timoshenko and Goodier 109 (torsion constant of the rectangle by the ratio of its sides), Cowper 1966 (shear
   factors 0.850, 0.886 and, thin tube, 0.531 at nu = 0.3), circle and tube in closed form. */
TEST(sections_from_dimensions_match_the_handbook)
{
  static const double ratio[][2] = {{1, 0.1406}, {1.5, 0.1958}, {2, 0.2287}, {3, 0.2633}, {4, 0.2808}, {10, 0.3123}};
  const fb_material steel = {FB_R(2.6e9), FB_R(1e9), FB_R(3.0)};
  fb_profile outline = {FB_PROFILE_RECTANGLE, FB_R(0.5), {FB_R(0.0), FB_R(0.0)}};
  fb_section s;
  const double pi = 3.14159265358979324;
  for (int k = 0; k < 2 * FBT_COUNT(ratio); k++) {
    const double a = 0.2 * ratio[k / 2][0], y = k % 2 ? a : 0.2, z = k % 2 ? 0.2 : a;
    outline.size[0] = (fb_real)y;
    outline.size[1] = (fb_real)z;
    FBT_INT_EQ(fb_section_init(&s, &steel, &outline), FB_OK);
    FBT_NEAR_REL(torsion_factor(ratio[k / 2][0]), ratio[k / 2][1], 5e-4);
    FBT_NEAR_REL(s.GJ, 1e9 * torsion_factor(ratio[k / 2][0]) * a * 0.008, FBT_TOL(1e-13, 1e-6));
    FBT_NEAR_REL(s.EA, 2.6e9 * y * z, 8.0 * EPS);
    FBT_NEAR_REL(s.EI_y, 2.6e9 * y * z * z * z / 12.0, 8.0 * EPS);
    FBT_NEAR_REL(s.EI_z, 2.6e9 * z * y * y * y / 12.0, 8.0 * EPS);
    FBT_NEAR_REL(s.mass, 3.0 * y * z, 8.0 * EPS);
    FBT_NEAR_REL(s.i_y, 3.0 * y * z * z * z / 12.0, 8.0 * EPS);
    FBT_NEAR_REL(s.i_z, 3.0 * z * y * y * y / 12.0, 8.0 * EPS);
    FBT_NEAR_REL(s.GA_y, 0.8497 * 1e9 * y * z, 1e-4);
    FBT_NEAR_ABS(s.x, 0.5, 0.0);
  }
  outline.size[0] = FB_R(6.0); /* ERRATA.md L8: J = 1.790 of the 6 x 1 section */
  outline.size[1] = FB_R(1.0);
  FBT_INT_EQ(fb_section_init(&s, &steel, &outline), FB_OK);
  FBT_NEAR_REL(s.GJ, 1.790e9, 3e-4);
  outline.kind = FB_PROFILE_TUBE;
  for (int k = 0; k < 2; k++) {
    const double inner = k ? 0.0 : 5.999, area = pi * (36.0 - inner * inner), I = area * (36.0 + inner * inner) / 4.0;
    outline.size[1] = (fb_real)inner;
    FBT_INT_EQ(fb_section_init(&s, &steel, &outline), FB_OK);
    FBT_NEAR_REL(s.EA, 2.6e9 * area, FBT_TOL(1e-12, 1e-3));
    FBT_NEAR_REL(s.EI_y, 2.6e9 * I, FBT_TOL(1e-12, 1e-3));
    FBT_NEAR_REL(s.GJ, 2e9 * I, FBT_TOL(1e-12, 1e-3));
    FBT_NEAR_REL(s.i_z, 3.0 * I, FBT_TOL(1e-12, 1e-3));
    FBT_NEAR_REL(s.GA_z, (k ? 0.8864 : 0.5306) * 1e9 * area, 1e-3);
  }
}

/* E6.14: a taper that begins along the beam: its stations are where the interval is divided, to the last bit at its
   end, their mass as linear between them the integral of (1 - s/2) (2 - s) over 3 m. What stands behind them stays. */
TEST(a_taper_may_begin_anywhere)
{
  double mass = 0.0;
  const fb_material unit = {FB_R(2.0), FB_R(1.0), FB_R(1.0)};
  const fb_profile from = {FB_PROFILE_RECTANGLE, FB_R(2.0), {FB_R(1.0), FB_R(2.0)}};
  const fb_profile to = {FB_PROFILE_RECTANGLE, FB_R(5.0), {FB_R(0.5), FB_R(1.0)}};
  uniform_desc(&desc, 3);
  desc.length = FB_R(5.0);
  desc.n_station = 0;
  FBT_INT_EQ(fb_beam_desc_add_taper(&desc, &unit, &from, &to, 7), FB_OK);
  FBT_INT_EQ(desc.n_station, 7);
  for (int k = 0; k < 7; k++) {
    const double s = k / 6.0;
    FBT_NEAR_REL(desc.station[k].x, 2.0 + 3.0 * s, FBT_TOL(1e-14, 1e-6));
    mass += (k % 6 ? 0.5 : 0.25) * (double)desc.station[k].mass; /* trapezoids of 1/2 m */
  }
  FBT_NEAR_REL(mass, 3.5, FBT_TOL(1e-14, 1e-6));
  for (int n = 2; n < 60; n++) {
    const fb_profile thin = {FB_PROFILE_RECTANGLE, FB_R(0.3) + FB_R(0.7) / (fb_real)n, {FB_R(0.5), FB_R(1.0)}};
    fb_profile start = from;
    start.x = FB_R(0.1);
    desc.n_station = 0;
    desc.station[n].x = FB_R(-7.0);
    FBT_INT_EQ(fb_beam_desc_add_taper(&desc, &unit, &start, &thin, n), FB_OK);
    FBT_NEAR_ABS(desc.station[n - 1].x, (double)thin.x, 0.0);
    FBT_NEAR_ABS(desc.station[n].x, -7.0, 0.0);
  }
}

/* E6.10: a taper has the same stations from either end. */
TEST(a_taper_reads_the_same_from_both_ends)
{
  const fb_material unit = {FB_R(2.0), FB_R(1.0), FB_R(1.0)};
  const fb_profile end[2] = {{FB_PROFILE_RECTANGLE, FB_R(0.0), {FB_R(1.0), FB_R(2.0)}},
                             {FB_PROFILE_RECTANGLE, FB_R(0.0), {FB_R(0.3), FB_R(1.5)}}};
  static fb_beam_desc way[2];
  for (int n = 2; n < 8; n++) {
    for (int back = 0; back < 2; back++) {
      fb_profile to = end[!back];
      to.x = FB_R(3.0);
      uniform_desc(&way[back], 1);
      way[back].n_station = 0;
      FBT_INT_EQ(fb_beam_desc_add_taper(&way[back], &unit, &end[back], &to, n), FB_OK);
    }
    for (int k = 0; k < n; k++) {
      const fb_section *const a = &way[0].station[k], *const b = &way[1].station[n - 1 - k];
      FBT_NEAR_ABS(a->x + b->x, 3.0, FBT_TOL(1e-14, 1e-6));
      FBT_NEAR_REL(a->mass, b->mass, FBT_TOL(1e-12, 1e-5));
      FBT_NEAR_REL(a->GJ, b->GJ, FBT_TOL(1e-12, 1e-4));
      FBT_NEAR_REL(a->EI_y, b->EI_y, FBT_TOL(1e-12, 1e-4));
      FBT_NEAR_REL(a->EI_z, b->EI_z, FBT_TOL(1e-12, 1e-4));
      FBT_NEAR_REL(a->i_z, b->i_z, FBT_TOL(1e-12, 1e-4));
    }
  }
}

/* E6.14: however thin its end, a station of a taper has no more than the section there and, lowered for its chords,
   at least half of it. */
TEST(a_thin_end_keeps_half)
{
  const fb_material unit = {FB_R(2.0), FB_R(1.0), FB_R(1.0)};
  const fb_profile thick = {FB_PROFILE_RECTANGLE, FB_R(0.0), {FB_R(1.0), FB_R(2.0)}};
  for (int n = 3; n < 7; n++) {
    for (int thin = 1; thin < 40; thin++) {
      fb_profile end = thick;
      end.x = FB_R(3.0);
      end.size[0] /= (fb_real)thin;
      end.size[1] /= (fb_real)thin;
      uniform_desc(&desc, 3);
      desc.n_station = 0;
      FBT_INT_EQ(fb_beam_desc_add_taper(&desc, &unit, &thick, &end, n), FB_OK);
      for (int k = 0; k < n; k++) {
        fb_section own;
        const fb_section *const s = &desc.station[k];
        fb_profile here = thick;
        for (int i = 0; i < 2; i++) {
          here.size[i] += (fb_real)k / (fb_real)(n - 1) * (end.size[i] - thick.size[i]);
        }
        FBT_INT_EQ(fb_section_init(&own, &unit, &here), FB_OK);
        const double part[6] = {(double)(s->mass / own.mass), (double)(s->EI_y / own.EI_y),
                                (double)(s->EI_z / own.EI_z), (double)(s->GJ / own.GJ),
                                (double)(s->GA_z / own.GA_z), (double)(s->i_y / own.i_y)};
        for (int i = 0; i < 6; i++) {
          FBT_TRUE(part[i] > 0.5 - FBT_TOL(1e-12, 1e-4) && part[i] < 1.0 + FBT_TOL(1e-12, 1e-4));
        }
      }
    }
  }
}

/* Interface: what is wrong with a material or a profile is refused, the output kept. */
TEST(bad_profiles_are_refused)
{
  const fb_material good = {FB_R(2.0), FB_R(1.0), FB_R(1.0)};
  const fb_profile root = {FB_PROFILE_RECTANGLE, FB_R(0.0), {FB_R(1.0), FB_R(2.0)}};
  const fb_profile tip = {FB_PROFILE_RECTANGLE, FB_R(1.0), {FB_R(0.5), FB_R(1.0)}};
  fb_section s, kept;
  memset(&kept, 0xA5, sizeof kept);
  s = kept;
  for (int fault = 0; fault < 10; fault++) {
    fb_material m = good;
    fb_profile p = root;
    fb_status expected = FB_ERR_VALUE;
    m.E *= (fb_real)(fault == 0 ? 0 : 1);
    m.G *= (fb_real)(fault == 1 ? -1 : 1);
    m.density *= (fb_real)(fault == 2 ? -1 : 1);
    p.size[0] *= (fb_real)(fault == 3 ? 0 : 1);
    p.size[1] *= (fb_real)(fault == 4 ? -1 : 1);
    p.kind = fault == 5 || fault == 6 ? FB_PROFILE_TUBE : p.kind; /* inner > outer */
    if (fault == 7) {
      const int unknown = 2;
      memcpy(&p.kind, &unknown, sizeof p.kind);
    }
    p.size[1] = fault == 6 ? p.size[0] : p.size[1];
    if (fault >= 8) {
      *(fault == 8 ? &m.E : &p.size[1]) = (fb_real)NAN;
      expected = FB_ERR_NOT_FINITE;
    }
    FBT_INT_EQ(fb_section_init(&s, &m, &p), expected);
    FBT_TRUE(memcmp(&s, &kept, sizeof s) == 0);
    uniform_desc(&desc, 3);
    beam.desc = desc;
    FBT_INT_EQ(fb_beam_desc_add_taper(&desc, &m, &p, &tip, 5), expected);
    FBT_TRUE(memcmp(&beam.desc, &desc, sizeof desc) == 0);
  }
  for (int n = 2; n <= 6; n++) { /* a thin end stays a beam */
    fb_profile point = tip;
    point.size[0] = FB_R(0.02);
    point.size[1] = FB_R(0.01);
    uniform_desc(&desc, 3);
    desc.length = FB_R(1.0);
    desc.n_station = 0;
    FBT_INT_EQ(fb_beam_desc_add_taper(&desc, &good, &root, &point, n), FB_OK);
    FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
    FBT_TRUE(desc.station[n - 1].EI_y > FB_R(0.0));
  }
  uniform_desc(&desc, 3);
  beam.desc = desc;
  FBT_INT_EQ(fb_section_init(NULL, &good, &root), FB_ERR_NULL);
  FBT_INT_EQ(fb_beam_desc_add_taper(&desc, &good, &root, &tip, 1), FB_ERR_VALUE);
  FBT_INT_EQ(fb_beam_desc_add_taper(&desc, &good, &tip, &root, 3), FB_ERR_VALUE);
  FBT_INT_EQ(fb_beam_desc_add_taper(&desc, &good, &root, &tip, FB_MAX_STATIONS + 1), FB_ERR_CAPACITY);
  FBT_TRUE(memcmp(&beam.desc, &desc, sizeof desc) == 0);
}

/* Displacement (0..2) or rotation (3..5) of the tip of the clamped beam under a unit force at its tip: K u = f by
   LU. */
static double tip_flexibility(int response, int force)
{
  static fb_real A[MAX_DOF * MAX_DOF], f[MAX_DOF], u[MAX_DOF], scale[MAX_DOF];
  static int perm[MAX_DOF];
  const int ndof = 6 * (desc.n_element + 1), n = ndof - 6;
  FBT_INT_EQ(fb_beam_init(&beam, &desc), FB_OK);
  fb_beam_matrices_eval(&beam, K, M);
  for (int i = 0; i < n * n; i++) {
    A[i] = K[(6 + i / n) * ndof + 6 + i % n];
  }
  memset(f, 0, sizeof f);
  f[n - 6 + force] = FB_R(1.0);
  FBT_INT_EQ(fb_lu_factor(A, perm, scale, n), FB_OK);
  fb_lu_solve(u, A, perm, f, n);
  return (double)u[n - 6 + response];
}

/* E6.11, E6.3: a quarter circle of radius R as a chain from the root along x to the tip (R, R, 0): tip deflection by
   Castigliano, in its plane (3 pi/4 - 2) F R^3/EI along y and pi/4 F R^3/EI along x, across it F R^3 (pi/4/EI + (3
   pi/4 - 2)/GJ); the error of an inscribed chain falls with the square of the element length. */
TEST(a_chain_follows_its_points)
{
  const double pi = 3.14159265358979324, bend_y = 5.3, bend_z = 1.9, twist = 3.7;
  const double exact[3] = {pi / 4.0 / bend_z, (0.75 * pi - 2.0) / bend_z,
                           pi / 4.0 / bend_y + (0.75 * pi - 2.0) / twist};
  double error[2][3];
  for (int fine = 0; fine < 2; fine++) {
    const int n = (int)FBT_TOL(8, 4) << fine;
    uniform_desc(&desc, n);
    desc.station[0].EA = (fb_real)FBT_TOL(1e6, 1e3); /* Castigliano's formulas leave stretch out */
    desc.n_point = n + 1;
    for (int k = 0; k <= n; k++) {
      desc.point[k][0] = (fb_real)sin(0.5 * pi * k / n);
      desc.point[k][1] = (fb_real)(1.0 - cos(0.5 * pi * k / n));
    }
    for (int axis = 0; axis < 3; axis++) {
      error[fine][axis] = tip_flexibility(axis, axis) / exact[axis] - 1.0;
      FBT_BELOW(fabs(error[fine][axis]), FBT_TOL(0.05, 0.2) / (1 << 2 * fine) + FBT_TOL(0.0, 1e-2));
    }
    FBT_NEAR_REL(beam.start[n], 2.0 * n * sin(pi / (4.0 * n)), 8.0 * EPS);
  }
  for (int axis = 0; axis < 3 && !FB_SINGLE; axis++) {
    FBT_NEAR_ABS(log2(error[0][axis] / error[1][axis]), 2.0, 0.1);
  }
  uniform_desc(&desc, 4); /* points in a row across x: the straight beam turned */
  desc.n_point = 5;
  for (int k = 0; k <= 4; k++) {
    desc.point[k][2] = desc.length * (fb_real)k / FB_R(4.0);
  }
  desc.length = FB_R(0.0); /* that of the points counts */
  FBT_NEAR_REL(tip_flexibility(2, 2), 1.7 / 7.1, 64.0 * EPS);
  FBT_NEAR_REL(tip_flexibility(1, 1), pow(1.7, 3.0) / (3.0 * 1.9), FBT_TOL(1e-12, 1e-4));
  FBT_NEAR_REL(tip_flexibility(0, 0), pow(1.7, 3.0) / (3.0 * 5.3), FBT_TOL(1e-12, 1e-4));
}

/* E6.12: a pretwisted cantilever, twist b x: tip flexibility int (L - x)^2 (cos^2/EI_z + sin^2/EI_y) dx along y, and
   across it int (L - x)^2 sin cos (1/EI_z - 1/EI_y) dx, by Simpson's rule. */
TEST(a_pretwisted_beam_bends_as_its_sections_turn)
{
  const double L = 1.7, bend_y = 5.3, bend_z = 1.9, angle = 1.3;
  double along = 0.0, across = 0.0;
  for (int k = 0; k <= 200; k++) {
    const double x = k / 200.0, w = (k == 0 || k == 200 ? 1.0 : k % 2 ? 4.0 : 2.0) / 600.0 * L;
    const double c = cos(angle * x), s = sin(angle * x), arm = L * (1.0 - x);
    along += w * arm * arm * (c * c / bend_z + s * s / bend_y);
    across += w * arm * arm * c * s * (1.0 / bend_z - 1.0 / bend_y);
  }
  uniform_desc(&desc, (int)FBT_TOL(20, 8));
  desc.n_station = 2;
  desc.station[1] = desc.station[0];
  desc.station[1].x = desc.length;
  desc.station[1].twist = (fb_real)angle;
  FBT_NEAR_REL(tip_flexibility(1, 1), along, FBT_TOL(1e-6, 3e-3));
  FBT_NEAR_REL(tip_flexibility(2, 1), across, FBT_TOL(1e-6, 5e-3));
  FBT_NEAR_REL(tip_flexibility(1, 2), across, FBT_TOL(1e-6, 5e-3));
}

/* E6.12, E6.13: statics of a uniform cantilever with its centers off the line: a pull at the line bends about the
   tension center, u_y = y_t L^2/2EI_z, u_z = z_t L^2/2EI_y, u_x = L/EA + y_t^2 L/EI_z + z_t^2 L/EI_y; a side force
   twists about the shear center, theta_x = z_s L/GJ, u_y = L^3/3EI_z + L/GA_y + z_s^2 L/GJ. Turned sections (twist)
   turn it all. */
TEST(offset_centers_bend_and_twist_as_in_statics)
{
  const double L = 1.7, y_t = 0.11, z_t = -0.07, y_s = 0.05, z_s = 0.13;
  for (int turned = 0; turned < 2; turned++) {
    const double t = turned ? 0.6 : 0.0, c = cos(t), s = sin(t);
    const double pull_y = y_t * L * L / 2.0 / 1.9, pull_z = z_t * L * L / 2.0 / 5.3; /* section axes */
    const double side_y = L * L * L / 3.0 / 1.9 + L / 17.0 + z_s * z_s * L / 3.7;
    const double side_z = L * L * L / 3.0 / 5.3 + L / 60.0 + y_s * y_s * L / 3.7, cross = -y_s * z_s * L / 3.7;
    fb_section *section = desc.station;
    uniform_desc(&desc, 3);
    section->GA_y = FB_R(17.0);
    section->GA_z = FB_R(60.0);
    section->twist = (fb_real)t;
    section->tension_y = (fb_real)y_t;
    section->tension_z = (fb_real)z_t;
    section->shear_y = (fb_real)y_s;
    section->shear_z = (fb_real)z_s;
    FBT_NEAR_REL(tip_flexibility(0, 0), L / 7.1 + y_t * y_t * L / 1.9 + z_t * z_t * L / 5.3, FBT_TOL(1e-13, 1e-5));
    FBT_NEAR_REL(tip_flexibility(1, 0), c * pull_y - s * pull_z, FBT_TOL(1e-13, 1e-5));
    FBT_NEAR_REL(tip_flexibility(2, 0), s * pull_y + c * pull_z, FBT_TOL(1e-13, 1e-5));
    FBT_NEAR_REL(tip_flexibility(1, 1), c * c * side_y - 2.0 * c * s * cross + s * s * side_z, FBT_TOL(1e-13, 1e-5));
    FBT_NEAR_REL(tip_flexibility(2, 2), s * s * side_y + 2.0 * c * s * cross + c * c * side_z, FBT_TOL(1e-13, 1e-5));
    FBT_NEAR_REL(tip_flexibility(3, 1), (c * z_s + s * y_s) * L / 3.7, FBT_TOL(1e-13, 1e-5));
  }
}

SUITE(beam, RUN(a_pretwisted_beam_bends_as_its_sections_turn), RUN(offset_centers_bend_and_twist_as_in_statics),
      RUN(sections_from_dimensions_match_the_handbook), RUN(a_taper_may_begin_anywhere),
      RUN(a_taper_reads_the_same_from_both_ends), RUN(a_thin_end_keeps_half), RUN(bad_profiles_are_refused),
      RUN(a_chain_follows_its_points), RUN(element_matrices_match_the_textbook_ones),
      RUN(rigid_motion_of_an_element_gives_no_strain), RUN(tapered_stations_integrate_exactly),
      RUN(sections_are_interpolated_between_stations), RUN(lumped_bodies_must_have_a_physical_inertia),
      RUN(bad_beams_are_refused_and_leave_the_output_alone), RUN(right_angles_leave_no_round_off),
      RUN(good_beams_keep_their_desc))
