/* Section 8: shape integrals, momentum form, effects, loads, nodes, energy. The judge is a brute-force model of
   particles that knows nothing of momenta or shape integrals: positions r + psi q + 1/2 chi q q, Newton's law per
   particle. */
#include "fbt.h"

#define PARTICLES 30
#define MAX_N 8

typedef struct particles {
  int n;
  double m[PARTICLES], r[PARTICLES][3], psi[PARTICLES][MAX_N][3], chi[PARTICLES][MAX_N][MAX_N][3];
} particles;

/* As the library sees it. */
static double rounded(double x)
{
  return (double)(fb_real)x;
}

/* Random masses, places and modes; quadratic: random symmetric chi. */
static void particles_random(particles *p, int n, int quadratic)
{
  memset(p, 0, sizeof *p);
  p->n = n;
  for (int i = 0; i < PARTICLES; i++) {
    p->m[i] = rounded(1.0 + 0.5 * fbt_random());
    for (int k = 0; k < 3; k++) {
      p->r[i][k] = rounded(fbt_random());
      for (int a = 0; a < n; a++) {
        p->psi[i][a][k] = rounded(0.4 * fbt_random());
        for (int b = 0; quadratic && b <= a; b++) {
          p->chi[i][a][b][k] = p->chi[i][b][a][k] = rounded(0.1 * fbt_random());
        }
      }
    }
  }
}

/* Orthonormalizes the modes so that M = 1 (Gram-Schmidt). */
static void particles_normalize(particles *p)
{
  for (int a = 0; a < p->n; a++) {
    for (int pass = 0; pass < 2; pass++) {
      double norm = 0.0;
      for (int b = 0; b < a; b++) {
        double overlap = 0.0;
        for (int i = 0; i < PARTICLES; i++) {
          for (int k = 0; k < 3; k++) {
            overlap += p->m[i] * p->psi[i][a][k] * p->psi[i][b][k];
          }
        }
        for (int i = 0; i < PARTICLES; i++) {
          for (int k = 0; k < 3; k++) {
            p->psi[i][a][k] -= overlap * p->psi[i][b][k];
          }
        }
      }
      for (int i = 0; i < PARTICLES; i++) {
        for (int k = 0; k < 3; k++) {
          norm += p->m[i] * p->psi[i][a][k] * p->psi[i][a][k];
        }
      }
      for (int i = 0; i < PARTICLES; i++) {
        for (int k = 0; k < 3; k++) {
          p->psi[i][a][k] /= sqrt(norm);
        }
      }
    }
  }
}

static void particles_to_shape(fb_shape *shape, const particles *p)
{
  FBT_INT_EQ(fb_shape_init(shape, p->n), FB_OK);
  for (int i = 0; i < PARTICLES; i++) {
    fb_real r[3], psi[3 * MAX_N], chi[3 * MAX_N * MAX_N];
    for (int k = 0; k < 3; k++) {
      r[k] = (fb_real)p->r[i][k];
      for (int a = 0; a < p->n; a++) {
        psi[3 * a + k] = (fb_real)p->psi[i][a][k];
        for (int b = 0; b < p->n; b++) {
          chi[3 * (a * p->n + b) + k] = (fb_real)p->chi[i][a][b][k];
        }
      }
    }
    FBT_INT_EQ(fb_shape_add_particle(shape, (fb_real)p->m[i], r, psi, chi), FB_OK);
  }
}

typedef struct velocity {
  double v[3], w[3], q[MAX_N], qd[MAX_N];
} velocity;

static void velocity_random(velocity *s, int n, double deflection)
{
  for (int k = 0; k < 3; k++) {
    s->v[k] = rounded(fbt_random());
    s->w[k] = rounded(fbt_random());
  }
  for (int a = 0; a < n; a++) {
    s->q[a] = rounded(deflection * fbt_random());
    s->qd[a] = rounded(fbt_random());
  }
}

static void cross(double c[3], const double a[3], const double b[3])
{
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

/* Position, its variation J (n x 3) and velocity of particle i, body axes. */
static void particle_at(double x[3], double J[MAX_N][3], double xd[3], const particles *p, int i, const velocity *s)
{
  for (int k = 0; k < 3; k++) {
    x[k] = p->r[i][k];
    for (int a = 0; a < p->n; a++) {
      J[a][k] = p->psi[i][a][k];
      for (int b = 0; b < p->n; b++) {
        J[a][k] += p->chi[i][a][b][k] * s->q[b];
      }
      x[k] += 0.5 * s->q[a] * (p->psi[i][a][k] + J[a][k]);
    }
  }
  cross(xd, s->w, x);
  for (int k = 0; k < 3; k++) {
    xd[k] += s->v[k];
    for (int a = 0; a < p->n; a++) {
      xd[k] += J[a][k] * s->qd[a];
    }
  }
}

/* Kinetic energy of the particles. */
static double particles_energy(const particles *p, const velocity *s)
{
  double T = 0.0;
  for (int i = 0; i < PARTICLES; i++) {
    double x[3], J[MAX_N][3], xd[3];
    particle_at(x, J, xd, p, i, s);
    T += 0.5 * p->m[i] * (xd[0] * xd[0] + xd[1] * xd[1] + xd[2] * xd[2]);
  }
  return T;
}

/* The part of the kinetic energy that is kept: elastic degree (q and qd together) at most 2, exact by interpolation of
   the quartic in a scale factor. */
static double particles_energy_2(const particles *p, const velocity *s)
{
  double T[5], c1, c2;
  for (int k = 0; k < 5; k++) {
    velocity e = *s;
    for (int a = 0; a < p->n; a++) {
      e.q[a] *= k - 2;
      e.qd[a] *= k - 2;
    }
    T[k] = particles_energy(p, &e);
  }
  c1 = (T[0] - 8.0 * T[1] + 8.0 * T[3] - T[4]) / 12.0;
  c2 = (-T[0] + 16.0 * T[1] - 30.0 * T[2] + 16.0 * T[3] - T[4]) / 24.0;
  return T[2] + c1 + c2;
}

static void solve(double *x, double *A, double *b, int n)
{
  for (int k = 0; k < n; k++) {
    int row = k;
    for (int i = k; i < n; i++) {
      row = fabs(A[i * n + k]) > fabs(A[row * n + k]) ? i : row;
    }
    for (int j = 0; j < n; j++) {
      const double t = A[k * n + j];
      A[k * n + j] = A[row * n + j];
      A[row * n + j] = t;
    }
    {
      const double t = b[k];
      b[k] = b[row];
      b[row] = t;
    }
    for (int i = k + 1; i < n; i++) {
      const double f = A[i * n + k] / A[k * n + k];
      for (int j = k; j < n; j++) {
        A[i * n + j] -= f * A[k * n + j];
      }
      b[i] -= f * b[k];
    }
  }
  for (int i = n - 1; i >= 0; i--) {
    x[i] = b[i];
    for (int j = i + 1; j < n; j++) {
      x[i] -= A[i * n + j] * x[j];
    }
    x[i] /= A[i * n + i];
  }
}

/* Newton's law of the particles (chi = 0) under force f and torque g about O and modal forces fe - K q: accelerations
   (v_dot, w_dot, q_ddot) as rates of the components. */
static void particles_accelerate(double *acc, const particles *p, const velocity *s, const double F[6 + MAX_N])
{
  const int n = p->n, N = 6 + n;
  double A[(6 + MAX_N) * (6 + MAX_N)] = {0}, b[6 + MAX_N];
  memcpy(b, F, sizeof(double) * (size_t)N);
  for (int i = 0; i < PARTICLES; i++) {
    double x[3], J[MAX_N][3], xd[3], jac[6 + MAX_N][3], bias[3], ud[3], t[3];
    particle_at(x, J, xd, p, i, s);
    for (int k = 0; k < 3; k++) {
      const double e[3] = {k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0};
      memcpy(jac[k], e, sizeof e);
      cross(jac[3 + k], e, x);
    }
    memcpy(jac[6], J, sizeof(double) * 3 * (size_t)n);
    cross(t, s->w, x);
    for (int k = 0; k < 3; k++) {
      ud[k] = xd[k] - s->v[k] - t[k];
      t[k] += s->v[k] + 2.0 * ud[k];
    }
    cross(bias, s->w, t);
    for (int a = 0; a < N; a++) {
      for (int k = 0; k < 3; k++) {
        b[a] -= p->m[i] * jac[a][k] * bias[k];
      }
      for (int c = 0; c < N; c++) {
        for (int k = 0; k < 3; k++) {
          A[a * N + c] += p->m[i] * jac[a][k] * jac[c][k];
        }
      }
    }
  }
  solve(acc, A, b, N);
}

static fb_body body;
static fb_body_work body_work;
static fb_shape shape, other;
static particles cloud;

static void state_from(fb_state *state, const fb_body *b, const velocity *s)
{
  fb_real v[3], w[3], qd[MAX_N];
  FBT_INT_EQ(fb_state_init(b, state), FB_OK);
  for (int k = 0; k < 3; k++) {
    v[k] = (fb_real)s->v[k];
    w[k] = (fb_real)s->w[k];
  }
  for (int a = 0; a < cloud.n; a++) {
    state->q[a] = (fb_real)s->q[a];
    qd[a] = (fb_real)s->qd[a];
  }
  FBT_INT_EQ(fb_state_from_velocity(b, state, v, w, qd), FB_OK);
}

/* E8.1, E8.4 to E8.6, E8.10, E8.12, E8.17, E8.19: degree 1 and residual inertia are exact. */
TEST(accelerations_agree_with_a_particle_model)
{
  double worst = 0.0;
  for (int n = 1; n <= MAX_N; n++) {
    for (int normal = 0; normal < 2; normal++) {
      velocity s;
      fb_state state;
      fb_motion motion;
      fb_input input;
      fb_body_desc desc;
      double F[6 + MAX_N] = {0}, acc[6 + MAX_N], scale = 0.0, error = 0.0;
      particles_random(&cloud, n, 0);
      if (normal) {
        particles_normalize(&cloud);
      }
      particles_to_shape(&shape, &cloud);
      for (int a = 0; a < n; a++) {
        shape.K[a * n + a] = (fb_real)(3.0 + a);
      }
      memset(&desc, 0, sizeof desc);
      desc.effects = FB_EFFECT_ELASTIC | FB_EFFECT_SPIN_COUPLING | FB_EFFECT_RESIDUAL_INERTIA;
      desc.allow_split_effects = 1;
      desc.deflection_limit = FB_R(100.0);
      FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
      FBT_INT_EQ(body.unit_mass, normal);
      velocity_random(&s, n, 0.5);
      state_from(&state, &body, &s);
      memset(&input, 0, sizeof input);
      input.n_load = 1;
      input.load[0].axes = FB_AXES_BODY;
      fbt_fill(input.load[0].force, 3, 1.0);
      fbt_fill(input.load[0].torque, 3, 1.0);
      for (int k = 0; k < 3; k++) {
        F[k] = (double)input.load[0].force[k];
        F[3 + k] = (double)input.load[0].torque[k];
      }
      for (int a = 0; a < n; a++) {
        F[6 + a] = -(3.0 + a) * s.q[a];
      }
      particles_accelerate(acc, &cloud, &s, F);
      FBT_INT_EQ(fb_body_motion(&body, &motion, &state, &input), FB_OK);
      for (int a = 0; a < 6 + n; a++) {
        const double got = (double)(a < 3 ? fbt_v_dot(&motion)[a] : a < 6 ? motion.w_dot[a - 3] : motion.q_ddot[a - 6]);
        scale = fmax(scale, fabs(acc[a]));
        error = fmax(error, fabs(got - acc[a]));
      }
      worst = fmax(worst, error / scale);
      FBT_BELOW(error / scale, FBT_TOL(1e-12, 1e-5));
      for (int a = 0; a < n; a++) {
        FBT_NEAR_ABS(motion.q_dot[a], s.qd[a], FBT_TOL(1e-12, 2e-5));
      }
    }
  }
  fbt_figure("accelerations, n = 1..8, normalized and general M", "Newton's law of 30 particles", worst);
}

/* Total momenta of a state in body axes: (p, h) about O, then pi = those relative to the mass center + (dc/dq)^T R^T u. */
static double momentum_of(const fb_state *state, int a)
{
  fb_real R[9], u[3], h[3], c[3] = {0};
  double more = 0.0;
  fb_quat_to_mat33(R, state->quat);
  fb_mat33_mulT_vec3(u, R, state->u);
  if (a < 3) {
    return (double)(body.mass * u[a]);
  }
  for (int i = 0; i < 3; i++) { /* mass center and how modes move it, of the particles */
    c[i] = shape.c[i];
    for (int b = 0; b < shape.n; b++) {
      double slope = (double)shape.P[3 * b + i];
      for (int d = 0; d < shape.n; d++) {
        slope += (double)(shape.pchi[3 * (b * shape.n + d) + i] * state->q[d]);
      }
      c[i] += (fb_real)(0.5 * ((double)shape.P[3 * b + i] + slope) * (double)state->q[b]);
      more += b == a - 6 ? slope * (double)u[i] : 0.0;
    }
  }
  if (a >= 6) {
    return (double)state->pi[a - 6] + more;
  }
  fb_mat33_mulT_vec3(h, R, state->L);
  return (double)h[a - 3] + (double)(c[(a + 1) % 3] * u[(a + 2) % 3] - c[(a + 2) % 3] * u[(a + 1) % 3]);
}

/* E8.9, E8.11, E8.13, E8.21: momenta are the derivatives of the particles' kinetic energy, degree 2 with chi. */
TEST(momenta_agree_with_a_particle_model)
{
  double worst = 0.0;
  for (int n = 1; n <= MAX_N; n++) {
    velocity s;
    fb_state state;
    fb_energy energy;
    fb_motion motion;
    fb_body_desc desc;
    double error = 0.0;
    particles_random(&cloud, n, 1);
    particles_to_shape(&shape, &cloud);
    memset(&desc, 0, sizeof desc);
    desc.effects = FB_EFFECTS_FULL;
    desc.deflection_limit = FB_R(100.0);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
    velocity_random(&s, n, 0.2);
    state_from(&state, &body, &s);
    for (int a = 0; a < 6 + n; a++) { /* the energy is quadratic in the velocities: central differences are exact */
      velocity up = s, down = s;
      double *x = a < 3 ? &up.v[a] : a < 6 ? &up.w[a - 3] : &up.qd[a - 6];
      double *y = a < 3 ? &down.v[a] : a < 6 ? &down.w[a - 3] : &down.qd[a - 6];
      const double got = momentum_of(&state, a);
      *x += 1.0;
      *y -= 1.0;
      error = fmax(error, fabs(0.5 * (particles_energy_2(&cloud, &up) - particles_energy_2(&cloud, &down)) - got));
    }
    worst = fmax(worst, error);
    FBT_BELOW(error, FBT_TOL(1e-12, 1e-4));
    FBT_INT_EQ(fb_body_energy(&body, &energy, &state, NULL), FB_OK);
    FBT_NEAR_REL(energy.kinetic, particles_energy_2(&cloud, &s), FBT_TOL(1e-12, 1e-5));
    FBT_INT_EQ(fb_body_motion(&body, &motion, &state, NULL), FB_OK);
    for (int a = 0; a < n; a++) {
      FBT_NEAR_ABS(motion.q_dot[a], s.qd[a], FBT_TOL(1e-12, 1e-4));
    }
  }
  fbt_figure("momenta with the quadratic field", "kinetic energy of 30 particles", worst);
}

/* E8.12 with chi: pi_dot = dT/dq at fixed velocities (Lagrange), by finite differences of the particles' energy. */
TEST(elastic_forces_agree_with_a_particle_model)
{
  for (int n = 1; n <= MAX_N; n++) {
    velocity s;
    fb_state state, rate;
    fb_body_desc desc;
    fb_real R[9], u[3];
    particles_random(&cloud, n, 1);
    particles_to_shape(&shape, &cloud);
    memset(&desc, 0, sizeof desc);
    desc.effects = FB_EFFECTS_FULL;
    desc.deflection_limit = FB_R(100.0);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
    velocity_random(&s, n, 0.2);
    state_from(&state, &body, &s);
    FBT_INT_EQ(fb_body_rates(&body, &rate, &state, NULL), FB_OK);
    fb_quat_to_mat33(R, state.quat);
    fb_mat33_mulT_vec3(u, R, state.u);
    for (int i = 0; i < 3; i++) { /* in the frame of the mass center */
      s.v[i] -= (double)u[i];
    }
    for (int a = 0; a < n; a++) {
      velocity up = s, down = s;
      up.q[a] += 1.0; /* quadratic in q at fixed velocities: exact */
      down.q[a] -= 1.0;
      FBT_NEAR_ABS(rate.pi[a], 0.5 * (particles_energy_2(&cloud, &up) - particles_energy_2(&cloud, &down)),
                   FBT_TOL(1e-12, 1e-4));
    }
  }
}

/* ---- every set of effects against its own Lagrangian, formed from the particles without shape integrals */

static void add_minus_cross_cross(double J[9], double m, const double a[3], const double b[3])
{
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      J[3 * i + j] += m * ((i == j ? a[0] * b[0] + a[1] * b[1] + a[2] * b[2] : 0.0) - b[i] * a[j]);
    }
  }
}

/* 6 x n momenta of the modes at q: [psi + chi q ; r x (psi + chi q) + (psi q) x psi], as the switches tell. */
static void coupling(double G[6][MAX_N], const particles *p, const double *q, int ups, int chi)
{
  memset(G, 0, sizeof(double) * 6 * MAX_N);
  for (int i = 0; i < PARTICLES; i++) {
    double u[3] = {0};
    for (int a = 0; a < p->n; a++) {
      for (int k = 0; k < 3; k++) {
        u[k] += ups ? p->psi[i][a][k] * q[a] : 0.0;
      }
    }
    for (int b = 0; b < p->n; b++) {
      double f[3], h[3], t[3];
      for (int k = 0; k < 3; k++) {
        f[k] = p->psi[i][b][k];
        for (int a = 0; a < p->n; a++) {
          f[k] += chi ? p->chi[i][a][b][k] * q[a] : 0.0;
        }
      }
      cross(h, p->r[i], f);
      cross(t, u, p->psi[i][b]);
      for (int k = 0; k < 3; k++) {
        G[k][b] += p->m[i] * f[k];
        G[3 + k][b] += p->m[i] * (h[k] + t[k]);
      }
    }
  }
}

/* Rigid mass matrix at q with the terms of the switches. */
static void rigid(double R[6][6], const particles *p, const double *q, unsigned effects)
{
  double m = 0.0, c[3] = {0}, J[9] = {0};
  for (int i = 0; i < PARTICLES; i++) {
    double u[3] = {0}, u2[3] = {0}, x[3];
    for (int a = 0; a < p->n; a++) {
      for (int k = 0; k < 3; k++) {
        u[k] += effects & FB_EFFECT_RESIDUAL_INERTIA ? p->psi[i][a][k] * q[a] : 0.0;
        for (int b = 0; b < p->n; b++) {
          u2[k] += 0.5 * p->chi[i][a][b][k] * q[a] * q[b];
        }
      }
    }
    m += p->m[i];
    for (int k = 0; k < 3; k++) {
      x[k] = p->r[i][k] + u[k];
      c[k] += p->m[i] * (x[k] + (effects & FB_EFFECT_ACCELERATION_STIFFENING ? u2[k] : 0.0));
    }
    add_minus_cross_cross(J, p->m[i], x, x);
    if (effects & FB_EFFECT_SPIN_STIFFENING) {
      add_minus_cross_cross(J, p->m[i], p->r[i], u2);
      add_minus_cross_cross(J, p->m[i], u2, p->r[i]);
    }
  }
  memset(R, 0, sizeof(double) * 36);
  for (int k = 0; k < 3; k++) {
    const double e[3] = {k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0};
    double t[3];
    cross(t, c, e);
    R[k][k] = m;
    for (int j = 0; j < 3; j++) {
      R[3 + j][k] = t[j];
      R[k][3 + j] = t[j];
      R[3 + k][3 + j] = J[3 * k + j];
    }
  }
}

/* Kinetic energy of a set of effects, 1/2 V^T S V + 1/2 pi^T M^-1 pi with pi = M q_dot + G^T V. */
static double set_energy(const particles *p, const velocity *s, unsigned effects)
{
  const int n = p->n, ups = (effects & FB_EFFECT_SPIN_COUPLING) != 0,
            chi = (effects & FB_EFFECT_ACCELERATION_STIFFENING) != 0;
  double G[6][MAX_N], Gs[6][MAX_N], R[6][6], M[MAX_N * MAX_N] = {0}, A[MAX_N * MAX_N], V[6], pi[MAX_N], gv[MAX_N];
  double x[MAX_N], b[MAX_N], T = 0.0;
  coupling(G, p, s->q, ups, chi);
  coupling(Gs, p, s->q, ups && (effects & FB_EFFECT_RESIDUAL_INERTIA), chi);
  rigid(R, p, s->q, effects);
  memcpy(V, s->v, sizeof s->v);
  memcpy(V + 3, s->w, sizeof s->w);
  for (int i = 0; i < PARTICLES; i++) {
    for (int a = 0; a < n; a++) {
      for (int c = 0; c < n; c++) {
        for (int k = 0; k < 3; k++) {
          M[a * n + c] += p->m[i] * p->psi[i][a][k] * p->psi[i][c][k];
        }
      }
    }
  }
  for (int a = 0; a < n; a++) {
    pi[a] = gv[a] = 0.0;
    for (int c = 0; c < n; c++) {
      pi[a] += M[a * n + c] * s->qd[c];
    }
    for (int i = 0; i < 6; i++) {
      pi[a] += G[i][a] * V[i];
      gv[a] += Gs[i][a] * V[i];
    }
  }
  for (int i = 0; i < 6; i++) {
    for (int j = 0; j < 6; j++) {
      T += 0.5 * V[i] * R[i][j] * V[j];
    }
  }
  for (int pass = 0; pass < 2; pass++) {
    const double *rhs = pass ? pi : gv;
    memcpy(A, M, sizeof A);
    memcpy(b, rhs, sizeof b);
    solve(x, A, b, n);
    for (int a = 0; a < n; a++) {
      T += (pass ? 0.5 : -0.5) * rhs[a] * x[a];
    }
  }
  return T;
}

/* The generalized velocity or, for k >= 6 + n, coordinate number k. */
static double *entry(velocity *s, int k, int n)
{
  return k < 3 ? &s->v[k] : k < 6 ? &s->w[k - 3] : k < 6 + n ? &s->qd[k - 6] : &s->q[k - 6 - n];
}

static const double offset[4] = {-2.0, -1.0, 1.0, 2.0};

/* dT/dx_k, exact for quartics. */
static double slope(const particles *p, const velocity *s, unsigned effects, int k)
{
  double T[4];
  for (int i = 0; i < 4; i++) {
    velocity x = *s;
    *entry(&x, k, p->n) += offset[i];
    T[i] = set_energy(p, &x, effects);
  }
  return (T[0] - 8.0 * T[1] + 8.0 * T[2] - T[3]) / 12.0;
}

/* Lagrange's equations of a set of effects by exact differences: accelerations without any load. */
static void set_accelerate(double *acc, const particles *p, const velocity *s, unsigned effects)
{
  const int n = p->n, N = 6 + n;
  double A[(6 + MAX_N) * (6 + MAX_N)], b[6 + MAX_N], P[6], t[3];
  for (int i = 0; i < N; i++) {
    double along[4];
    for (int j = 0; j < N; j++) { /* mass matrix: T is quadratic in the velocities */
      velocity up = *s, down = *s;
      *entry(&up, j, n) += 0.5;
      *entry(&down, j, n) -= 0.5;
      A[i * N + j] = slope(p, &up, effects, i) - slope(p, &down, effects, i);
    }
    for (int k = 0; k < 4; k++) { /* momentum i along q_dot */
      velocity x = *s;
      for (int a = 0; a < n; a++) {
        x.q[a] += offset[k] * s->qd[a];
      }
      along[k] = slope(p, &x, effects, i);
    }
    b[i] = -(along[0] - 8.0 * along[1] + 8.0 * along[2] - along[3]) / 12.0;
    if (i < 6) {
      P[i] = slope(p, s, effects, i);
    } else {
      b[i] += slope(p, s, effects, N + i - 6);
    }
  }
  cross(t, s->w, P);
  for (int k = 0; k < 3; k++) {
    b[k] -= t[k];
  }
  cross(t, s->w, P + 3);
  for (int k = 0; k < 3; k++) {
    b[3 + k] -= t[k];
  }
  cross(t, s->v, P);
  for (int k = 0; k < 3; k++) {
    b[3 + k] -= t[k];
  }
  solve(acc, A, b, N);
}

static const unsigned effect_sets[] = {
    FB_EFFECTS_LINEAR,
    FB_EFFECTS_SPIN,
    FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA,
    FB_EFFECTS_LINEAR | FB_EFFECT_RESIDUAL_INERTIA,
    FB_EFFECTS_LINEAR | FB_EFFECT_SPIN_STIFFENING,
    FB_EFFECTS_SPIN | FB_EFFECT_ACCELERATION_STIFFENING,
    FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA | FB_EFFECT_SPIN_STIFFENING,
    FB_EFFECTS_FULL,
};

/* The same body in units of mass and length that are so many times smaller moves the same: no threshold has a unit. For
   every set of effects, with a stiffness. */
TEST(bodies_do_not_depend_on_the_units)
{
  const double mass[] = {FBT_TOL(8.5e-22, 6e-8), FBT_TOL(1.1e15, 65536.0), 1.0, 1.0};
  const double length[] = {1.0, 1.0, FBT_TOL(9.1e-13, 2.4e-4), FBT_TOL(1.1e12, 4096.0)};
  static const int n = 3;
  for (int set = 0; set < FBT_COUNT(effect_sets); set++) {
    fb_motion motion[5];
    particles in_meters;
    velocity s;
    particles_random(&in_meters, n, 1);
    velocity_random(&s, n, 0.1);
    for (int unit = 0; unit < 5; unit++) {
      const double kg = unit ? mass[unit - 1] : 1.0, m = unit ? length[unit - 1] : 1.0;
      velocity scaled = s;
      fb_state state;
      fb_body_desc desc;
      cloud = in_meters;
      for (int i = 0; i < PARTICLES; i++) {
        cloud.m[i] *= kg;
        for (int k = 0; k < 3; k++) {
          cloud.r[i][k] *= m;
          for (int ab = 0; ab < n * n; ab++) {
            cloud.chi[i][ab / n][ab % n][k] /= m;
          }
        }
      }
      for (int k = 0; k < 3; k++) {
        scaled.v[k] *= m;
        scaled.q[k] *= m;
        scaled.qd[k] *= m;
      }
      particles_to_shape(&shape, &cloud);
      for (int a = 0; a < n; a++) {
        shape.K[a * n + a] = (fb_real)(2.0 * kg);
      }
      memset(&desc, 0, sizeof desc);
      desc.effects = effect_sets[set];
      desc.allow_split_effects = 1;
      desc.deflection_limit = (fb_real)(100.0 * m);
      FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
      state_from(&state, &body, &scaled);
      FBT_INT_EQ(fb_body_motion(&body, &motion[unit], &state, NULL), FB_OK);
      for (int k = 0; k < 3; k++) {
        motion[unit].v[k] /= (fb_real)m;
        motion[unit].acceleration[k] /= (fb_real)m;
        motion[unit].q_ddot[k] /= (fb_real)m;
      }
      FBT_BELOW(fbt_difference(motion[unit].acceleration, motion[0].acceleration, 3), FBT_TOL(1e-12, 1e-4));
      FBT_BELOW(fbt_difference(motion[unit].w_dot, motion[0].w_dot, 3), FBT_TOL(1e-12, 1e-4));
      FBT_BELOW(fbt_difference(motion[unit].q_ddot, motion[0].q_ddot, n), FBT_TOL(1e-12, 1e-4));
    }
  }
}

/* The cloud with a unit of its own for each coordinate. */
static void particles_in_units(const particles *p, velocity *s, const double *unit)
{
  cloud = *p;
  for (int i = 0; i < PARTICLES; i++) {
    for (int ak = 0; ak < 3 * p->n; ak++) {
      cloud.psi[i][ak / 3][ak % 3] *= unit[ak / 3];
      for (int b = 0; b < p->n; b++) {
        cloud.chi[i][ak / 3][b][ak % 3] *= unit[ak / 3] * unit[b];
      }
    }
  }
  for (int a = 0; a < p->n; a++) {
    s->q[a] /= unit[a];
    s->qd[a] /= unit[a];
  }
}

/* E8.4 to E8.6, E8.17, E8.19: each coordinate may have a unit of its own, so that the modal masses are all 2 kg, or as far
   apart as numbers go: the body moves as before, for every set of effects, with stiffness and damping. */
TEST(coordinates_have_any_unit)
{
  static const int n = 3;
  for (int set = 0; set < FBT_COUNT(effect_sets); set++) {
    particles plain;
    fb_motion motion[4];
    velocity s;
    particles_random(&plain, n, 1);
    particles_normalize(&plain);
    velocity_random(&s, n, 0.1);
    for (int run = 0; run < 4; run++) { /* normalized, 2 kg, apart */
      const double apart = FBT_TOL(ldexp(1.0, 40), 1024.0);
      double unit[MAX_N];
      velocity scaled = s;
      fb_state state;
      fb_body_desc desc;
      for (int a = 0; a < n; a++) {
        unit[a] = run == 0 ? 1.0 : run == 1 ? sqrt(2.0) : pow(apart, (a + run) % 3 - 1.0);
      }
      particles_in_units(&plain, &scaled, unit);
      particles_to_shape(&shape, &cloud);
      memset(&desc, 0, sizeof desc);
      for (int ab = 0; ab < n * n; ab++) {
        shape.K[ab] = (fb_real)((ab % (n + 1) == 0 ? 3.0 + ab : 0.5) * unit[ab / n] * unit[ab % n]);
        desc.zeta[ab / n] = (fb_real)(0.1 + 0.1 * (ab / n));
      }
      desc.effects = effect_sets[set] | FB_EFFECT_DAMPING;
      desc.allow_split_effects = 1;
      desc.deflection_limit = FB_R(100.0);
      memset(&body_work, 0xff, sizeof body_work); /* what is in it means nothing */
      FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
      state_from(&state, &body, &scaled);
      FBT_INT_EQ(fb_body_motion(&body, &motion[run], &state, NULL), FB_OK);
      for (int a = 0; a < n; a++) {
        motion[run].q_ddot[a] *= (fb_real)unit[a];
      }
      FBT_BELOW(fbt_difference(motion[run].acceleration, motion[0].acceleration, 3), FBT_TOL(1e-11, 1e-3));
      FBT_BELOW(fbt_difference(motion[run].w_dot, motion[0].w_dot, 3), FBT_TOL(1e-11, 1e-3));
      FBT_BELOW(fbt_difference(motion[run].q_ddot, motion[0].q_ddot, n), FBT_TOL(1e-11, 1e-3));
    }
  }
}

/* First moment of mass of the particles as the set has it, at q + t q_dot + t^2/2 q_ddot. */
static void set_center(double c[3], const particles *p, const velocity *s, const double *q_ddot, unsigned effects,
                       double t)
{
  double q[MAX_N];
  for (int a = 0; a < p->n; a++) {
    q[a] = s->q[a] + t * s->qd[a] + 0.5 * t * t * q_ddot[a];
  }
  for (int i = 0; i < 3; i++) {
    c[i] = (double)shape.c[i];
    for (int a = 0; a < p->n; a++) {
      c[i] += (double)shape.P[3 * a + i] * q[a];
      for (int b = 0; b < p->n && (effects & FB_EFFECT_ACCELERATION_STIFFENING); b++) {
        c[i] += 0.5 * (double)shape.pchi[3 * (a * p->n + b) + i] * q[a] * q[b];
      }
    }
  }
}

/* Accelerations of a free body by a set of effects: Lagrange's equations in the frame of its mass center, where the
   momentum is zero, for sets of few effects are not the same in frames that fly; O is where the mass center leaves it. */
static void set_fall(double *acc, const particles *p, const velocity *s, unsigned effects)
{
  velocity fall = *s;
  double A[9], P[3], v[3], c[5][3], turn[3], rate[3], more[3];
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      velocity up = *s, down = *s;
      up.v[j] += 0.5;
      down.v[j] -= 0.5;
      A[3 * i + j] = slope(p, &up, effects, i) - slope(p, &down, effects, i);
    }
    P[i] = slope(p, s, effects, i);
  }
  solve(v, A, P, 3);
  for (int i = 0; i < 3; i++) {
    fall.v[i] -= v[i];
  }
  set_accelerate(acc, p, &fall, effects);
  for (int k = 0; k < 5; k++) { /* of degree 4 in t: differences over five points are exact */
    set_center(c[k], p, s, acc + 6, effects, 0.5 * (k - 2));
  }
  cross(turn, s->w, c[2]);
  for (int i = 0; i < 3; i++) {
    turn[i] += 2.0 * (c[0][i] - 8.0 * c[1][i] + 8.0 * c[3][i] - c[4][i]) / 6.0;
    rate[i] = (16.0 * (c[1][i] + c[3][i]) - 30.0 * c[2][i] - c[0][i] - c[4][i]) / 3.0;
  }
  cross(v, s->w, turn);
  cross(turn, acc + 3, c[2]);
  cross(more, s->w, s->v);
  for (int i = 0; i < 3; i++) { /* acceleration of O, less w x v */
    acc[i] = -(v[i] + turn[i] + rate[i]) / (double)shape.mass - more[i];
  }
}

/* E8.4 to E8.6, E8.17, E8.19: each effect alone and together. */
TEST(each_set_of_effects_follows_its_own_lagrangian)
{
  double worst = 0.0;
  for (int n = 1; n <= MAX_N; n += n < 3 ? 1 : 5) {
    for (int set = 0; set < FBT_COUNT(effect_sets); set++) {
      velocity s;
      fb_state state;
      fb_motion motion;
      fb_body_desc desc;
      double acc[6 + MAX_N], scale = 0.0, error = 0.0;
      particles_random(&cloud, n, 1);
      particles_to_shape(&shape, &cloud);
      memset(&desc, 0, sizeof desc);
      desc.effects = effect_sets[set];
      desc.allow_split_effects = 1;
      desc.deflection_limit = FB_R(100.0);
      FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
      velocity_random(&s, n, 0.1);
      state_from(&state, &body, &s);
      set_fall(acc, &cloud, &s, effect_sets[set]);
      FBT_INT_EQ(fb_body_motion(&body, &motion, &state, NULL), FB_OK);
      for (int a = 0; a < 6 + n; a++) {
        const double got = (double)(a < 3 ? fbt_v_dot(&motion)[a] : a < 6 ? motion.w_dot[a - 3] : motion.q_ddot[a - 6]);
        scale = fmax(scale, fabs(acc[a]));
        error = fmax(error, fabs(got - acc[a]));
      }
      worst = fmax(worst, error / scale);
      FBT_BELOW(error / scale, FBT_TOL(1e-12, 1e-4));
    }
  }
  fbt_figure("accelerations of 8 sets of effects", "Lagrange's equations of particles", worst);
}

/* Two scalar functions of the place. */
static double scalar_function(const double r[3], int which)
{
  return rounded(which ? 0.3 * sin(2.0 * r[0]) + 0.2 * r[1] : 0.4 * r[0] * r[0] - 0.1 * r[2]);
}

/* E8.6: with the same functions in x, y and z the residual inertia is zero, term by term. */
TEST(residual_inertia_vanishes_on_a_rotation_closed_basis)
{
  fb_body_desc desc;
  particles_random(&cloud, 6, 0);
  for (int i = 0; i < PARTICLES; i++) {
    for (int a = 0; a < 6; a++) {
      const double f = scalar_function(cloud.r[i], a >= 3);
      for (int k = 0; k < 3; k++) {
        cloud.psi[i][a][k] = a % 3 == k ? f : 0.0;
      }
    }
  }
  particles_to_shape(&shape, &cloud);
  memset(&desc, 0, sizeof desc);
  desc.effects = FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA;
  desc.allow_split_effects = 1;
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  FBT_TRUE(!body.constant_S);
  FBT_INT_EQ(body.n_S, 0);    /* the constant part alone: every other term vanished to rounding */
  cloud.psi[0][0][0] += 0.01; /* not closed any more */
  particles_to_shape(&shape, &cloud);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  FBT_TRUE(body.n_S > 0);
}

/* ---- a boom with everything on it */

static fb_beam_desc beam_desc;
static fb_beam beam;
static fb_modes modes;
static fb_modes_work modes_work;

/* E7.5, E8.4, E8.6: the same functions in each direction make a closed basis: S is constant and spin couples a function
   with itself alone. The function with strain at the root opens it. */
TEST(functions_close_the_basis)
{
  for (int root = 0; root < 2; root++) {
    static fb_modes_desc keep;
    static fb_body_desc desc;
    const int m = 3;
    memset(&beam_desc, 0, sizeof beam_desc);
    memset(&keep, 0, sizeof keep);
    memset(&desc, 0, sizeof desc);
    beam_desc.length = FB_R(3.0);
    beam_desc.n_element = 2;
    beam_desc.n_station = 1;
    beam_desc.station[0].mass = FB_R(2.0);
    beam_desc.station[0].EI_y = FB_R(5.0);
    beam_desc.station[0].EI_z = FB_R(7.0);
    beam_desc.station[0].EA = FB_R(900.0);
    beam_desc.n_lump = 1;
    beam_desc.lump[0].node = 2;
    beam_desc.lump[0].mass = FB_R(0.5);
    keep.basis = FB_BASIS_FUNCTIONS;
    keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = keep.count[FB_KIND_AXIAL] = m;
    keep.root_strain = root;
    desc.effects = FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA;
    desc.allow_split_effects = 1;
    desc.base = FB_BASE_PRESCRIBED;
    FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
    FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
    FBT_TRUE(body.unit_mass);
    FBT_BELOW(fbt_difference(shape.M, modes.M, modes.n * modes.n), FBT_TOL(1e-13, 1e-5));
    FBT_INT_EQ(body.n_lambda - body.n_lambda_constant, 6 * m);
    FBT_INT_EQ(body.n_S == 0, !root);
  }
}

#define BOOM_MODES 7

/* Rigid hub, boom off its axis in a skew direction with an offset tip body, bending, stretch and torsion modes, two
   nodes. */
static void boom(fb_shape *out, int node[2])
{
  static const fb_real center[3] = {FB_R(0.1), -FB_R(0.2), FB_R(0.05)};
  static const fb_real inertia[6] = {FB_R(3.0), FB_R(4.0), FB_R(5.0), FB_R(0.2), -FB_R(0.1), FB_R(0.3)};
  static const int count[FB_KIND_COUNT] = {2, 2, 1, 2};
  static fb_modes_desc keep;
  fb_lump *tip = &beam_desc.lump[0];
  memcpy(keep.count, count, sizeof count);
  memset(&beam_desc, 0, sizeof beam_desc);
  beam_desc.length = FB_R(4.0);
  beam_desc.n_element = 5;
  beam_desc.n_station = 2;
  for (int k = 0; k < 2; k++) {
    fb_section *s = &beam_desc.station[k];
    const fb_real taper = FB_R(1.0) - FB_R(0.4) * (fb_real)k;
    s->x = FB_R(4.0) * (fb_real)k;
    s->mass = taper;
    s->EA = FB_R(4000.0) * taper;
    s->GJ = FB_R(15.0) * taper;
    s->EI_y = FB_R(30.0) * taper;
    s->EI_z = FB_R(60.0) * taper;
    s->i_y = FB_R(0.01) * taper;
    s->i_z = FB_R(0.03) * taper;
  }
  beam_desc.n_lump = 1;
  tip->node = 5;
  tip->mass = FB_R(0.3);
  tip->center[1] = FB_R(0.1);
  tip->center[2] = -FB_R(0.05);
  tip->inertia[0] = tip->inertia[1] = tip->inertia[2] = FB_R(0.01);
  beam_desc.position[0] = FB_R(0.5);
  beam_desc.position[1] = FB_R(0.2);
  beam_desc.attitude[0] = FB_R(0.9);
  beam_desc.attitude[1] = FB_R(0.1);
  beam_desc.attitude[2] = -FB_R(0.3);
  beam_desc.attitude[3] = FB_R(0.2);
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(modes.n, BOOM_MODES);
  FBT_INT_EQ(fb_shape_init(out, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(out, FB_R(6.0), center, inertia), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(out, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(out, &node[0], 0, &beam, &modes, FB_R(4.0)), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(out, &node[1], 0, &beam, &modes, FB_R(1.7)), FB_OK);
}

static void boom_body(unsigned effects, fb_base base, int node[2])
{
  static fb_body_desc desc;
  memset(&desc, 0, sizeof desc);
  desc.effects = effects;
  desc.base = base;
  desc.gravity[0] = FB_R(0.3);
  desc.gravity[2] = -FB_R(1.5);
  for (int k = 0; k < BOOM_MODES; k++) {
    desc.zeta[k] = FB_R(0.02);
  }
  boom(&shape, node);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
}

#define LARGE FB_MAX_MODES

/* Rows of `width` numbers, one of each of as many coordinates as there can be, for other coordinates: a mirror image in all
   of them, each in a unit of its own. */
static void combine(fb_real *x, int width)
{
  for (int j = 0; j < width; j++) {
    double sum = 0.0, square = 0.0;
    for (int a = 0; a < LARGE; a++) {
      sum += (1.0 + a % 3) * (double)x[a * width + j];
      square += (1.0 + a % 3) * (1.0 + a % 3);
    }
    for (int a = 0; a < LARGE; a++) {
      x[a * width + j] = (fb_real)(((double)x[a * width + j] - 2.0 * (1.0 + a % 3) * sum / square) * ldexp(1.0, a % 4));
    }
  }
}

/* The same coordinates of the same deflection. */
static void combine_state(fb_real *q)
{
  combine(q, 1);
  for (int a = 0; a < LARGE; a++) {
    q[a] = (fb_real)ldexp((double)q[a], -2 * (a % 4));
  }
}

/* A moving, deflected state; deflection of the modes of about size. Combined: the same in those other coordinates. */
static void moving_state(fb_state *state, double size, int combined)
{
  fb_real v[3], w[3], qd[FB_MAX_MODES];
  FBT_INT_EQ(fb_state_init(&body, state), FB_OK);
  fbt_fill(state->rho, 3, 2.0);
  fbt_fill(state->quat, 4, 1.0);
  FBT_INT_EQ(fb_quat_normalize(state->quat), FB_OK);
  fbt_fill(state->q, body.n, size);
  fbt_fill(v, 3, 1.0);
  fbt_fill(w, 3, 0.5);
  fbt_fill(qd, body.n, size);
  if (combined) {
    combine_state(state->q);
    combine_state(qd);
  }
  if (body.base == FB_BASE_PINNED || body.base == FB_BASE_HINGED) {
    memset(v, 0, sizeof v);
  }
  if (body.base == FB_BASE_HINGED) {
    w[0] = w[1] = 0;
  }
  FBT_INT_EQ(fb_state_from_velocity(&body, state, v, w, qd), FB_OK);
}

static void boom_state(fb_state *state, double size)
{
  moving_state(state, size, 0);
}

/* E8.1 to E8.3, E7.3: the quadrature over the beam reproduces the modal mass, and mass and inertia of the whole. */
TEST(beam_integrals_reproduce_mass_and_modal_mass)
{
  int node[2];
  boom(&shape, node);
  FBT_NEAR_REL(shape.mass, 6.0 + 4.0 * 0.8 + 0.3, FBT_TOL(1e-14, 1e-6));
  for (int a = 0; a < BOOM_MODES; a++) {
    for (int b = 0; b < BOOM_MODES; b++) {
      FBT_NEAR_ABS(shape.M[a * BOOM_MODES + b], a == b, FBT_TOL(1e-13, 2e-5));
    }
  }
}

/* E6.12, E6.11, E8.1: with twist, shear, every center off the line and a bent line the quadrature over the slices, each
   a rigid body placed by psi, still finds M = 1 of the eigenproblem, which integrates the fields of the section; mass,
   first moment and inertia are those of slices summed here. */
TEST(beam_integrals_hold_for_any_section_and_line)
{
  int node[2];
  double c[3] = {0.0, 0.0, 0.0}, trace = 0.0, mass = 0.0;
  boom(&shape, node);
  beam_desc.n_point = 6;
  for (int k = 0; k < 6; k++) {
    const double x = 0.8 * k;
    beam_desc.point[k][0] = (fb_real)x;
    beam_desc.point[k][1] = (fb_real)(0.04 * x * x);
    beam_desc.point[k][2] = (fb_real)(-0.02 * x * x);
  }
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_ERR_VALUE); /* the last station is not at the chain's end */
  beam_desc.station[1].x = FB_R(0.0);
  for (int k = 0; k < 5; k++) {
    double along = 0.0;
    for (int i = 0; i < 3; i++) {
      along += pow((double)beam_desc.point[k + 1][i] - (double)beam_desc.point[k][i], 2.0);
    }
    beam_desc.station[1].x += (fb_real)sqrt(along);
  }
  for (int k = 0; k < 2; k++) {
    fb_section *s = &beam_desc.station[k];
    s->GA_y = FB_R(300.0);
    s->GA_z = FB_R(500.0);
    s->twist = FB_R(0.4) - FB_R(0.9) * (fb_real)k;
    s->mass_y = FB_R(0.05);
    s->mass_z = -FB_R(0.08);
    s->tension_y = FB_R(0.03);
    s->tension_z = FB_R(0.02) * (fb_real)k;
    s->shear_y = -FB_R(0.04);
    s->shear_z = FB_R(0.06);
  }
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  for (int element_basis = 0; element_basis < 2; element_basis++) {
    static fb_modes_desc keep;
    memset(&keep, 0, sizeof keep);
    keep.basis = element_basis ? FB_BASIS_ELEMENTS : FB_BASIS_MODES;
    keep.count[FB_KIND_BEND_Y] = 3;
    keep.count[FB_KIND_BEND_Z] = 3;
    keep.count[FB_KIND_TORSION] = element_basis ? 0 : 1;
    FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
    FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
    for (int a = 0; a < modes.n; a++) {
      for (int b = 0; b < modes.n; b++) {
        const double size = sqrt((double)(modes.M[a * (modes.n + 1)] * modes.M[b * (modes.n + 1)]));
        FBT_NEAR_ABS(shape.M[a * modes.n + b], modes.M[a * modes.n + b], FBT_TOL(1e-12, 1e-4) * size);
      }
    }
  }
  for (int slice = 0; slice < 4000; slice++) {
    const double x = ((double)slice + 0.5) / 4000.0 * (double)beam.desc.length, dx = (double)beam.desc.length / 4000.0;
    int e = 0;
    fb_section s;
    double r[3], local[3], t;
    while (x > (double)beam.start[e + 1]) {
      e++;
    }
    fb_beam_section(&s, &beam, (fb_real)x);
    t = (double)s.twist;
    local[0] = x - (double)beam.start[e];
    local[1] = cos(t) * (double)s.mass_y - sin(t) * (double)s.mass_z;
    local[2] = sin(t) * (double)s.mass_y + cos(t) * (double)s.mass_z;
    for (int i = 0; i < 3; i++) {
      r[i] = (double)beam.desc.position[i];
      for (int j = 0; j < 3; j++) {
        double frame = 0.0;
        for (int k = 0; k < 3; k++) {
          frame += (double)beam.axes[3 * i + k] * (double)beam.frame[9 * e + 3 * k + j];
        }
        r[i] += frame * local[j] + (double)beam.axes[3 * i + j] * (double)beam.node[3 * e + j];
      }
    }
    mass += (double)s.mass * dx;
    for (int i = 0; i < 3; i++) {
      c[i] += (double)s.mass * dx * r[i];
      trace += 2.0 * (double)s.mass * dx * r[i] * r[i];
    }
    trace += 2.0 * ((double)s.i_y + (double)s.i_z) * dx;
  }
  mass += 0.3; /* the tip body */
  FBT_NEAR_REL(shape.mass, mass, FBT_TOL(1e-9, 1e-4));
  for (int i = 0; i < 3; i++) {
    const fb_lump *tip = &beam.desc.lump[0];
    double r = (double)beam.desc.position[i];
    for (int j = 0; j < 3; j++) {
      r += (double)beam.axes[3 * i + j] * ((double)beam.node[15 + j] + (double)tip->center[j]);
    }
    FBT_NEAR_REL(shape.c[i], c[i] + 0.3 * r, FBT_TOL(1e-6, 1e-3));
    trace += 2.0 * 0.3 * r * r + (double)tip->inertia[i];
  }
  FBT_NEAR_REL(shape.J[0] + shape.J[4] + shape.J[8], trace, FBT_TOL(1e-6, 1e-3));
}

/* Displacement and rotation (1, x, y, z of exp) at x of the boom's beam alone, bent, twisted and stretched by q. */
static void bent_at(double u[3], fb_real R[9], double x, const double *q)
{
  const fb_node *n = &shape.node[1];
  fb_real phi[3] = {0}, quat[4];
  int at;
  shape.n_node = 1;
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &at, 0, &beam, &modes, (fb_real)x), FB_OK);
  for (int k = 0; k < 3; k++) {
    double turn = 0.0;
    u[k] = 0.0;
    for (int a = 0; a < modes.n; a++) {
      u[k] += (double)n->psi[3 * a + k] * q[a];
      turn += (double)n->theta[3 * a + k] * q[a];
      for (int b = 0; b < modes.n; b++) {
        const int pair = a > b ? a * (a + 1) / 2 + b : b * (b + 1) / 2 + a;
        u[k] += 0.5 * (double)n->chi[3 * pair + k] * q[a] * q[b];
        turn += 0.5 * (double)n->chi_theta[3 * pair + k] * q[a] * q[b];
      }
    }
    phi[k] = (fb_real)turn;
  }
  fb_quat_from_rotvec(quat, phi);
  fb_quat_to_mat33(R, quat);
}

/* E8.2: a beam bent in both planes and twisted. The section's normal is the tangent of the deformed line, whose length
   is unchanged, and the twist rate about it is that of the torsion coordinates: defects of third degree, 8 times less
   at half the amplitude. */
TEST(quadratic_field_is_inextensible_and_twist_free)
{
  double tangent[2], stretch[2], twist[2];
  static fb_modes_desc keep;
  int node[2];
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 2;
  keep.count[FB_KIND_TORSION] = 1;
  boom(&shape, node);
  beam_desc.n_lump = 0;
  memset(beam_desc.position, 0, sizeof beam_desc.position);
  memset(beam_desc.attitude, 0, sizeof beam_desc.attitude);
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  for (int scale = 0; scale < 2; scale++) {
    const double size = 0.15 / (1 + scale), h = FBT_TOL(1e-3, 0.1);
    const double q[5] = {size, -0.7 * size, 0.2 * size, 0.3 * size, 0.3 * size}, q_torsion[5] = {0};
    double q1[5];
    tangent[scale] = stretch[scale] = twist[scale] = 0.0;
    for (int a = 0; a < 5; a++) {
      q1[a] = modes.kind[a] == FB_KIND_TORSION ? q[a] : q_torsion[a];
    }
    for (double x = 0.5; x < 3.9; x += 0.4) {
      double up[3], down[3], t[3], length = 0.0;
      fb_real R[9], Ru[9], Rd[9], rate[9], linear_up[9], linear_down[9];
      bent_at(up, R, x, q);
      bent_at(up, Ru, x + h, q);
      bent_at(down, Rd, x - h, q);
      for (int k = 0; k < 3; k++) {
        t[k] = (k == 0) + (up[k] - down[k]) / (2.0 * h);
        length += t[k] * t[k];
        tangent[scale] = fmax(tangent[scale], fabs(t[k] - (double)R[3 * k]));
      }
      stretch[scale] = fmax(stretch[scale], fabs(sqrt(length) - 1.0));
      for (int k = 0; k < 9; k++) { /* kappa_x = z . y' */
        rate[k] = (Ru[k] - Rd[k]) / (fb_real)(2.0 * h);
      }
      bent_at(up, linear_up, x + h, q1);
      bent_at(down, linear_down, x - h, q1);
      {
        const double kappa = (double)(R[2] * rate[1] + R[5] * rate[4] + R[8] * rate[7]);
        const double phi =
            atan2((double)linear_up[7], (double)linear_up[8]) - atan2((double)linear_down[7], (double)linear_down[8]);
        twist[scale] = fmax(twist[scale], fabs(kappa - phi / (2.0 * h)));
      }
    }
  }
  FBT_BELOW(tangent[0], 2e-2);
  FBT_BELOW(tangent[1] / tangent[0], FBT_TOL(1.0 / 6.0, 1.0 / 3.0));
  FBT_BELOW(stretch[1] / stretch[0], FBT_TOL(1.0 / 6.0, 1.0 / 3.0));
  FBT_BELOW(twist[1] / twist[0], FBT_TOL(1.0 / 6.0, 1.0 / 3.0));
}

/* E8.2, E6.11: along a bent line, too, the deformed line has the length that the linear strain gives it, but for third
   degree; and the field turns with the beam: in an attitude R it is R times that in the body axes. */
TEST(quadratic_field_follows_a_bent_line_in_any_attitude)
{
  static fb_modes_desc keep;
  double stretch[2] = {0.0, 0.0};
  fb_real before[3 * 15], quat[4] = {FB_R(0.5), -FB_R(0.7), FB_R(0.1), FB_R(0.5)}, R[9];
  int node[2];
  boom(&shape, node);
  beam_desc.n_lump = 0;
  memset(beam_desc.position, 0, sizeof beam_desc.position);
  memset(beam_desc.attitude, 0, sizeof beam_desc.attitude);
  beam_desc.n_point = 6;
  for (int k = 0; k < 6; k++) {
    beam_desc.point[k][0] = FB_R(0.7) * (fb_real)k;
    beam_desc.point[k][1] = FB_R(0.07) * (fb_real)(k * k);
    beam_desc.point[k][2] = -FB_R(0.04) * (fb_real)(k * k);
  }
  beam_desc.n_station = 1;
  beam_desc.station[0].GA_y = FB_R(200.0); /* the line's slope is not the section's turn */
  beam_desc.station[0].GA_z = FB_R(300.0);
  keep.lowest = 5;
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  for (int scale = 0; scale < 2; scale++) {
    const double size = 0.15 / (1 + scale), h = FBT_TOL(1e-3, 0.05);
    const double q[5] = {size, -0.7 * size, 0.2 * size, 0.3 * size, 0.1 * size};
    for (int e = 0; e < 5; e++) {
      const double x = (double)beam.start[e] + 0.4 * ((double)beam.start[e + 1] - (double)beam.start[e]);
      double line[3] = {0.0, 0.0, 0.0}, tangent[3] = {0.0, 0.0, 0.0}, linear[3] = {0.0, 0.0, 0.0};
      double strain = 0.0, length = 0.0;
      for (int side = -1; side < 2; side += 2) {
        const fb_node *n = &shape.node[1];
        shape.n_node = 1;
        FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node[0], 0, &beam, &modes, (fb_real)(x + side * h)), FB_OK);
        for (int i = 0; i < 3; i++) {
          double u = 0.0, second = 0.0;
          for (int a = 0; a < 5; a++) {
            u += (double)n->psi[3 * a + i] * q[a];
            for (int b = 0; b < 5; b++) {
              second += 0.5 * q[a] * q[b] * (double)n->chi[3 * (a > b ? a * (a + 1) / 2 + b : b * (b + 1) / 2 + a) + i];
            }
          }
          line[i] += side * (double)n->r[i] / (2.0 * h);
          linear[i] += side * u / (2.0 * h);
          tangent[i] += side * ((double)n->r[i] + u + second) / (2.0 * h);
        }
      }
      for (int i = 0; i < 3; i++) {
        strain += line[i] * linear[i];
        length += tangent[i] * tangent[i];
      }
      stretch[scale] = fmax(stretch[scale], fabs(sqrt(length) - 1.0 - strain));
    }
  }
  if (!FB_SINGLE) { /* an eighth or less; in single precision it drowns in the differences */
    FBT_BELOW(stretch[1] / stretch[0], 1.0 / 5.0);
  }
  FBT_BELOW(stretch[0], 2e-3);
  shape.n_node = 1;
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node[0], 0, &beam, &modes, beam.desc.length), FB_OK);
  memcpy(before, shape.node[1].chi, sizeof before);
  memcpy(beam_desc.attitude, quat, sizeof quat);
  FBT_INT_EQ(fb_quat_normalize(quat), FB_OK);
  fb_quat_to_mat33(R, quat);
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  shape.n_node = 1;
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node[0], 0, &beam, &modes, beam.desc.length), FB_OK);
  for (int pair = 0; pair < 15; pair++) {
    fb_real turned[3];
    fb_mat33_mul_vec3(turned, R, before + 3 * pair);
    FBT_BELOW(fbt_difference(turned, shape.node[1].chi + 3 * pair, 3),
              FBT_TOL(1e-13, 1e-5) * (1.0 + fbt_largest(turned, 3)));
  }
}

/* E8.3, E8.14: a mass off the axis sits where the section carries it: the integrals of the tip body equal those of a
   particle placed by the node's own displacement and rotation. */
TEST(offset_masses_move_with_their_section)
{
  int node[2];
  double with[2][3];
  for (int k = 0; k < 2;
       k++) { /* first moment p_a with and without the tip body: the difference is mass times psi there */
    boom(&shape, node);
    if (k == 1) {
      beam_desc.n_lump = 0;
      FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
      FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
      FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
      FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node[0], 0, &beam, &modes, FB_R(4.0)), FB_OK);
    }
    for (int i = 0; i < 3; i++) {
      with[k][i] = (double)shape.P[3 * 4 + i];
    }
  }
  {
    fb_real d[3], local[3] = {0, FB_R(0.1), -FB_R(0.05)}, turn[3];
    fb_mat33_mul_vec3(d, beam.axes, local);
    fb_vec3_cross(turn, shape.node[node[0]].theta + 3 * 4, d);
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(with[0][i] - with[1][i], 0.3 * (double)(shape.node[node[0]].psi[3 * 4 + i] + turn[i]),
                   FBT_TOL(1e-13, 1e-6));
    }
  }
}

/* Largest difference of the integrals of two shapes, those of a from coordinate first on, relative to the largest of
   each. */
static double shape_difference(const fb_shape *a, const fb_shape *b, int first)
{
  double worst = fmax(fbt_difference(a->c, b->c, 3), fbt_difference(a->J, b->J, 9)) / fbt_largest(b->J, 9);
  for (int i = 0; i < b->n; i++) {
    const int at = first + i;
    worst = fmax(worst, fbt_difference(a->P + 3 * at, b->P + 3 * i, 3) / fbt_largest(b->P, 3 * b->n));
    worst = fmax(worst, fbt_difference(a->H + 3 * at, b->H + 3 * i, 3) / fbt_largest(b->H, 3 * b->n));
    worst = fmax(worst, fbt_difference(a->Gam + 9 * at, b->Gam + 9 * i, 9) / fbt_largest(b->Gam, 9 * b->n));
    for (int k = 0; k < b->n; k++) {
      const int x = at * a->n + first + k, y = i * b->n + k, nn = b->n * b->n;
      worst = fmax(worst, fabs((double)(a->M[x] - b->M[y])));
      worst = fmax(worst, fabs((double)(a->K[x] - b->K[y])) / fbt_largest(b->K, nn));
      worst = fmax(worst, fbt_difference(a->ups + 3 * x, b->ups + 3 * y, 3));
      worst = fmax(worst, fbt_difference(a->Pi + 9 * x, b->Pi + 9 * y, 9));
      worst = fmax(worst, fbt_difference(a->pchi + 3 * x, b->pchi + 3 * y, 3) / fbt_largest(b->pchi, 3 * nn));
      worst = fmax(worst, fbt_difference(a->hchi + 3 * x, b->hchi + 3 * y, 3) / fbt_largest(b->hchi, 3 * nn));
      worst = fmax(worst, fbt_difference(a->Gamchi + 9 * x, b->Gamchi + 9 * y, 9) / fbt_largest(b->Gamchi, 9 * nn));
    }
  }
  return worst;
}

/* E6.2, E8.1, E8.3: a lumped body with offset and full inertia is the handful of particles it is made of, each moving
   as u + (exp(phi) - 1) d with the node's displacement and rotation to second degree. */
TEST(lumped_bodies_are_the_particles_they_stand_for)
{
  double m[5], d[5][3], total = 0.0, center[3] = {0}, S[3][3] = {{0}};
  int node[2];
  fb_lump *tip = &beam_desc.lump[0];
  boom(&shape, node);
  for (int i = 0; i < 5; i++) {
    m[i] = 0.1 + 0.05 * i;
    total += m[i];
    for (int k = 0; k < 3; k++) {
      d[i][k] = 0.2 * fbt_random();
      center[k] += m[i] * d[i][k];
    }
  }
  for (int i = 0; i < 5; i++) {
    for (int k = 0; k < 3; k++) {
      for (int l = 0; l < 3; l++) {
        S[k][l] += m[i] * (d[i][k] - center[k] / total) * (d[i][l] - center[l] / total);
      }
    }
  }
  tip->mass = (fb_real)total;
  for (int k = 0; k < 3; k++) {
    tip->center[k] = (fb_real)(center[k] / total);
    tip->inertia[k] = (fb_real)(S[0][0] + S[1][1] + S[2][2] - S[k][k]);
  }
  tip->inertia[3] = -(fb_real)S[0][1];
  tip->inertia[4] = -(fb_real)S[0][2];
  tip->inertia[5] = -(fb_real)S[1][2];
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  beam_desc.n_lump = 0;
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_shape_init(&other, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&other, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&other, &node[0], 0, &beam, &modes, FB_R(4.0)), FB_OK);
  for (int i = 0; i < 5; i++) {
    const fb_node *n = &other.node[node[0]];
    fb_real local[3], D[3], r[3], psi[3 * BOOM_MODES], chi[3 * BOOM_MODES * BOOM_MODES];
    for (int k = 0; k < 3; k++) {
      local[k] = (fb_real)d[i][k];
    }
    fb_mat33_mul_vec3(D, beam.axes, local);
    for (int a = 0; a < BOOM_MODES; a++) {
      fb_vec3_cross(psi + 3 * a, n->theta + 3 * a, D);
      for (int b = 0; b < BOOM_MODES; b++) {
        const int pair = a > b ? a * (a + 1) / 2 + b : b * (b + 1) / 2 + a;
        fb_real t[3], ab[3], ba[3], *x = chi + 3 * (a * BOOM_MODES + b);
        fb_vec3_cross(t, n->theta + 3 * b, D);
        fb_vec3_cross(ab, n->theta + 3 * a, t);
        fb_vec3_cross(t, n->theta + 3 * a, D);
        fb_vec3_cross(ba, n->theta + 3 * b, t);
        fb_vec3_cross(x, n->chi_theta + 3 * pair, D);
        for (int k = 0; k < 3; k++) {
          x[k] += n->chi[3 * pair + k] + FB_R(0.5) * (ab[k] + ba[k]);
        }
      }
      for (int k = 0; k < 3; k++) {
        psi[3 * a + k] += n->psi[3 * a + k];
      }
    }
    for (int k = 0; k < 3; k++) {
      r[k] = n->r[k] + D[k];
    }
    FBT_INT_EQ(fb_shape_add_particle(&other, (fb_real)m[i], r, psi, chi), FB_OK);
  }
  FBT_NEAR_REL(shape.mass, other.mass, FBT_TOL(1e-14, 1e-6));
  FBT_BELOW(shape_difference(&shape, &other, 0), FBT_TOL(1e-12, 1e-4));
}

/* E8.1, E8.3: a lump on a node that moves by psi and turns by theta has M_ab = m psi_a.psi_b + theta_a.I theta_b, h_a = m
   r x psi_a + I theta_a, J = I + m (r.r - r r^T), I any tensor of inertia. */
TEST(lumps_have_the_inertia_of_their_node)
{
  static const fb_real inertia[6] = {FB_R(0.5), FB_R(0.6), FB_R(0.7), FB_R(0.1), -FB_R(0.05), FB_R(0.08)};
  static const int packed[9] = {0, 3, 4, 3, 1, 5, 4, 5, 2}; /* xx, yy, zz, xy, xz, yz */
  const double m = 2.0;
  fb_real r[3], psi[6], theta[6];
  double I[9];
  fbt_seed(17);
  fbt_fill(r, 3, 1.0);
  fbt_fill(psi, 6, 1.0);
  fbt_fill(theta, 6, 1.0);
  FBT_INT_EQ(fb_shape_init(&shape, 2), FB_OK);
  FBT_INT_EQ(fb_shape_add_lump(&shape, (fb_real)m, r, inertia, psi, theta), FB_OK);
  for (int ij = 0; ij < 9; ij++) {
    const double square = ij % 4 == 0 ? (double)fb_vec3_dot(r, r) : 0.0;
    I[ij] = (double)inertia[packed[ij]];
    FBT_NEAR_ABS(shape.J[ij], I[ij] + m * (square - (double)(r[ij / 3] * r[ij % 3])), FBT_TOL(1e-14, 1e-5));
  }
  for (int a = 0; a < 2; a++) {
    const fb_real *t = theta + 3 * a;
    fb_real arm[3];
    fb_vec3_cross(arm, r, psi + 3 * a);
    for (int i = 0; i < 3; i++) {
      const double turned = I[3 * i] * (double)t[0] + I[3 * i + 1] * (double)t[1] + I[3 * i + 2] * (double)t[2];
      FBT_NEAR_ABS(shape.H[3 * a + i], m * (double)arm[i] + turned, FBT_TOL(1e-14, 1e-5));
    }
    for (int b = 0; b < 2; b++) {
      double M = m * (double)fb_vec3_dot(psi + 3 * a, psi + 3 * b);
      for (int ij = 0; ij < 9; ij++) {
        M += (double)t[ij / 3] * I[ij] * (double)theta[3 * b + ij % 3];
      }
      FBT_NEAR_ABS(shape.M[2 * a + b], M, FBT_TOL(1e-14, 1e-5));
    }
  }
}

/* A beam's coordinates may stand anywhere among those of the body. */
TEST(a_beam_may_take_later_coordinates)
{
  int node[2], at;
  fb_gauge gauge[2];
  fb_real q[BOOM_MODES + 3];
  boom(&shape, node);
  FBT_INT_EQ(fb_shape_init(&other, BOOM_MODES), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&other, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, BOOM_MODES + 3), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 3, &beam, &modes), FB_OK);
  FBT_TRUE(shape_difference(&shape, &other, 3) == 0.0);
  FBT_INT_EQ(fb_shape_add_beam_node(&other, &at, 0, &beam, &modes, FB_R(1.7)), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &at, 3, &beam, &modes, FB_R(1.7)), FB_OK);
  FBT_TRUE(fbt_difference(shape.node[1].psi + 9, other.node[1].psi, 3 * BOOM_MODES) == 0.0);
  FBT_TRUE(fbt_difference(shape.node[1].theta + 9, other.node[1].theta, 3 * BOOM_MODES) == 0.0);
  for (int a = 0, pair = 0; a < BOOM_MODES; a++) {
    for (int b = 0; b <= a; b++, pair += 3) {
      const int later = 3 * ((a + 3) * (a + 4) / 2 + b + 3);
      FBT_TRUE(fbt_difference(shape.node[1].chi + later, other.node[1].chi + pair, 3) == 0.0);
      FBT_TRUE(fbt_difference(shape.node[1].chi_theta + later, other.node[1].chi_theta + pair, 3) == 0.0);
    }
  }
  FBT_INT_EQ(fb_gauge_init(&gauge[0], 0, &beam, &modes, FB_R(1.7), FB_R(0.1), FB_R(0.2)), FB_OK);
  FBT_INT_EQ(fb_gauge_init(&gauge[1], 3, &beam, &modes, FB_R(1.7), FB_R(0.1), FB_R(0.2)), FB_OK);
  fbt_fill(q, BOOM_MODES + 3, 1.0);
  FBT_NEAR_ABS(fb_gauge_eval(&gauge[1], q), fb_gauge_eval(&gauge[0], q + 3), FBT_TOL(1e-14, 1e-5));
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0x7FFFFFFF, &beam, &modes), FB_ERR_CAPACITY);
}

/* out = state + h rate */
static void state_along(fb_state *out, const fb_state *state, const fb_state *rate, double h)
{
  *out = *state;
  for (int i = 0; i < 4; i++) {
    out->quat[i] += (fb_real)h * rate->quat[i];
  }
  for (int i = 0; i < 3; i++) {
    out->rho[i] += (fb_real)h * rate->rho[i];
    out->u[i] += (fb_real)h * rate->u[i];
    out->L[i] += (fb_real)h * rate->L[i];
  }
  for (int i = 0; i < body.n; i++) {
    out->q[i] += (fb_real)h * rate->q[i];
    out->pi[i] += (fb_real)h * rate->pi[i];
  }
}

/* Work of the loads in a second, by the motion of their nodes. */
static double power_of(const fb_state *state, const fb_input *input)
{
  fb_motion motion;
  double power = 0.0;
  FBT_INT_EQ(fb_body_motion(&body, &motion, state, input), FB_OK);
  for (int i = 0; i < input->n_load; i++) {
    const fb_load *load = &input->load[i];
    fb_real R[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, F[3], T[3];
    fb_node_motion at;
    FBT_INT_EQ(fb_body_node_motion(&body, &at, state, &motion, load->node), FB_OK);
    if (load->axes != FB_AXES_INERTIAL) {
      fb_quat_to_mat33(R, load->axes == FB_AXES_NODE ? at.quat : state->quat);
    }
    fb_mat33_mul_vec3(F, R, load->force);
    fb_mat33_mul_vec3(T, R, load->torque);
    power += (double)(fb_vec3_dot(F, at.velocity) + fb_vec3_dot(T, at.angular_rate));
  }
  return power;
}

/* Rate of the energy along the rates of the state, by a difference. */
static double energy_rate(const fb_state *state, const fb_input *input, double h)
{
  fb_state rate, ahead, behind;
  fb_energy up, down;
  FBT_INT_EQ(fb_body_rates(&body, &rate, state, input), FB_OK);
  state_along(&ahead, state, &rate, h);
  state_along(&behind, state, &rate, -h);
  FBT_INT_EQ(fb_body_energy(&body, &up, &ahead, NULL), FB_OK);
  FBT_INT_EQ(fb_body_energy(&body, &down, &behind, NULL), FB_OK);
  return ((double)(up.kinetic - down.kinetic) + (double)(up.strain - down.strain) +
          (double)(up.gravity - down.gravity)) /
         (2.0 * h);
}

/* E8.15, E8.16, E8.21: the work of the loads, less damping, is the change of energy: an identity of the rates. */
TEST(power_of_loads_is_the_rate_of_energy)
{
  static const fb_base base[] = {FB_BASE_FREE, FB_BASE_PINNED, FB_BASE_HINGED};
  int node[2];
  for (int k = 0; k < 9; k++) {
    fb_state state;
    fb_input input;
    boom_body(FB_EFFECTS_FULL | FB_EFFECT_GRAVITY, base[k / 3], node);
    boom_state(&state, 0.05);
    memset(&input, 0, sizeof input);
    input.n_load = 2;
    for (int i = 0; i < 2; i++) {
      input.load[i].node = node[i];
      input.load[i].axes = (fb_axes)(k % 3);
      fbt_fill(input.load[i].force, 3, 2.0);
      fbt_fill(input.load[i].torque, 3, 1.0);
    }
    FBT_NEAR_ABS(energy_rate(&state, &input, FBT_TOL(1e-5, 1e-2)), power_of(&state, &input), FBT_TOL(1e-7, 5e-2));
  }
}

/* ---- as many coordinates, nodes and loads as there can be */

static void combine_pairs(fb_real *x, int width)
{
  combine(x, LARGE * width);
  for (int a = 0; a < LARGE; a++) {
    combine(x + a * LARGE * width, width);
  }
}

/* Random numbers of each pair of coordinates, `width` of them; symmetric. */
static void pairs_random(fb_real *x, int width, double scale)
{
  fbt_fill(x, LARGE * LARGE * width, scale);
  for (int a = 0; a < LARGE; a++) {
    for (int b = 0; b < a; b++) {
      memcpy(x + width * (a * LARGE + b), x + width * (b * LARGE + a), sizeof(fb_real) * (size_t)width);
    }
  }
}

/* Shapes, linear and quadratic, of one place. */
static void shapes_random(fb_real *psi, fb_real *chi, int combined)
{
  fbt_fill(psi, 3 * LARGE, 0.3);
  pairs_random(chi, 3, 0.05);
  if (combined) {
    combine(psi, 3);
    combine_pairs(chi, 3);
  }
}

/* Particles, a lumped body and nodes that move by all coordinates. */
static void large_shape(int combined)
{
  static const fb_real inertia[6] = {FB_R(0.5), FB_R(0.6), FB_R(0.7), FB_R(0.1), -FB_R(0.05), FB_R(0.08)};
  static fb_real chi[3 * LARGE * LARGE], turn[3 * LARGE * LARGE];
  fb_real r[3], psi[3 * LARGE], theta[3 * LARGE];
  int node = 0;
  fbt_seed(23);
  FBT_INT_EQ(fb_shape_init(&shape, LARGE), FB_OK);
  for (int k = 0; k < PARTICLES; k++) {
    fbt_fill(r, 3, 1.0);
    shapes_random(psi, chi, combined);
    FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(1.5), r, psi, chi), FB_OK);
  }
  for (int k = 1; k < FB_MAX_NODES; k++) {
    fbt_fill(r, 3, 1.0);
    shapes_random(psi, chi, combined);
    shapes_random(theta, turn, combined);
    FBT_INT_EQ(fb_shape_add_node(&shape, &node, r, psi, theta), FB_OK);
    FBT_INT_EQ(node, k);
    for (int a = 0, pair = 0; a < LARGE; a++) {
      for (int b = 0; b <= a; b++, pair += 3) {
        memcpy(shape.node[node].chi + pair, chi + 3 * (a * LARGE + b), 3 * sizeof(fb_real));
        memcpy(shape.node[node].chi_theta + pair, turn + 3 * (a * LARGE + b), 3 * sizeof(fb_real));
      }
    }
  }
  FBT_INT_EQ(fb_shape_add_node(&shape, &node, r, psi, theta), FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_shape_add_lump(&shape, FB_R(2.0), r, inertia, psi, theta), FB_OK);
  pairs_random(shape.K, 1, 0.3);
  for (int a = 0; a < LARGE; a++) {
    shape.K[a * (LARGE + 1)] = (fb_real)(9.0 + a);
  }
  if (combined) {
    combine_pairs(shape.K, 1);
  }
}

static void large_body(int form, fb_base base, unsigned damping, int combined)
{
  static fb_body_desc level;
  memset(&level, 0, sizeof level);
  FBT_SET_FORM(level, form);
  level.base = base;
  level.effects = (form == FBT_FIRST ? FB_EFFECTS_SPIN : FB_EFFECTS_FULL) | damping | FB_EFFECT_GRAVITY;
  level.gravity[0] = FB_R(0.3);
  level.gravity[2] = -FB_R(1.5);
  for (int a = 0; a < LARGE; a++) {
    level.zeta[a] = (fb_real)(0.01 + 0.001 * a);
  }
  large_shape(combined);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
  FBT_INT_EQ(fb_body_check(&body), FB_OK);
  FBT_TRUE(fb_body_crc(&body) != 0);
}

/* A load on each node, in all axes. */
static void large_input(fb_input *input)
{
  memset(input, 0, sizeof *input);
  input->n_load = FB_MAX_LOADS;
  for (int k = 0; k < FB_MAX_LOADS; k++) {
    input->load[k].node = k % FB_MAX_NODES;
    input->load[k].axes = (fb_axes)(k % 3);
    fbt_fill(input->load[k].force, 3, 2.0);
    fbt_fill(input->load[k].torque, 3, 1.0);
  }
  fbt_fill(input->v, 3, 1.0);
  fbt_fill(input->w, 3, 0.5);
  fbt_fill(input->v_dot, 3, 1.0);
  fbt_fill(input->w_dot, 3, 1.0);
}

typedef struct outcome { /* all reals: what a body does, in whichever coordinates */
  fb_real limit[6], v[3], w[3], acceleration[3], w_dot[3], q_ddot[LARGE], force[3], torque[3];
  fb_energy energy;
  fb_momentum momentum;
  fb_node_motion node[FB_MAX_NODES];
} outcome;

static void large_outcome(outcome *out, int combined)
{
  fb_state state;
  fb_motion motion;
  fb_input input;
  moving_state(&state, 0.05, combined);
  large_input(&input);
  FBT_INT_EQ(fb_state_check(&body, &state), FB_OK);
  FBT_INT_EQ(fb_body_motion(&body, &motion, &state, &input), FB_OK);
  FBT_INT_EQ(fb_body_energy(&body, &out->energy, &state, &input), FB_OK);
  FBT_INT_EQ(fb_body_momentum(&body, &out->momentum, &state, &input), FB_OK);
  for (int k = 0; k < FB_MAX_NODES; k++) {
    FBT_INT_EQ(fb_body_node_motion(&body, &out->node[k], &state, &motion, k), FB_OK);
  }
  if (!combined) {
    combine_state(motion.q_ddot);
  }
  for (int a = 0; a < LARGE; a++) { /* in the unit of the others */
    out->q_ddot[a] = (fb_real)ldexp((double)motion.q_ddot[a], a % 4);
  }
  memcpy(out->v, motion.v, sizeof out->v);
  memcpy(out->w, motion.w, sizeof out->w);
  memcpy(out->acceleration, motion.acceleration, sizeof out->acceleration);
  memcpy(out->w_dot, motion.w_dot, sizeof out->w_dot);
  memcpy(out->force, motion.reaction_force, sizeof out->force);
  memcpy(out->torque, motion.reaction_torque, sizeof out->torque);
  out->limit[0] = body.limit_elastic;
  out->limit[1] = body.limit_damping;
  out->limit[2] = body.limit_spin;
  out->limit[3] = body.limit_acceleration;
  out->limit[4] = body.recoil;
  out->limit[5] = body.gyration;
}

/* E8.1 to E8.22, E8.25, E8.28: any combination of the coordinates describes the same body, in every form and on every base,
   with as many coordinates, nodes and loads as there can be: bounds, accelerations, reactions, energies, momenta and the
   motion of every node. */
TEST(combined_coordinates_are_the_same_body)
{
  double worst = 0.0;
  for (int run = 0; run < 4 * FBT_FORMS; run++) {
    outcome plain, other_way;
    const fb_real *const a = (const fb_real *)&plain, *const b = (const fb_real *)&other_way;
    large_body((run / 4), (fb_base)(run % 4), FB_EFFECT_DAMPING, 0);
    large_outcome(&plain, 0);
    large_body((run / 4), (fb_base)(run % 4), FB_EFFECT_DAMPING, 1);
    large_outcome(&other_way, 1);
    for (size_t i = 0; i < sizeof plain / sizeof(fb_real); i++) {
      worst = fmax(worst, fabs((double)(a[i] - b[i])) / (1.0 + fabs((double)a[i])));
    }
    FBT_BELOW(worst, FBT_TOL(1e-12, 1e-3));
  }
}

/* E8.15 to E8.18, E8.25, E8.27: that body, free and without damping: the work of all its loads is the change of its energy. */
TEST(power_of_all_loads_is_the_rate_of_energy)
{
  for (int form = 0; form < FBT_FORMS; form++) {
    fb_state state;
    fb_input input;
    large_body(form, FB_BASE_FREE, 0, 0);
    moving_state(&state, 0.05, 0);
    large_input(&input);
    FBT_NEAR_ABS(energy_rate(&state, &input, FBT_TOL(1e-5, 1e-2)), power_of(&state, &input), FBT_TOL(1e-7, 0.1));
  }
}

/* Energy, momentum and the motion of every node with the velocities of some coordinates; what the others do is zero. */
static void some_move(outcome *out, const fb_shape *of, const int *place, int n)
{
  static fb_body_desc level;
  fb_state state;
  fb_motion motion;
  fb_real q[3][LARGE];
  memset(&level, 0, sizeof level);
  level.effects = FB_EFFECTS_FULL | FB_EFFECT_GRAVITY;
  level.gravity[1] = FB_R(2.0);
  FBT_INT_EQ(fb_body_init(&body, &body_work, of, &level), FB_OK);
  fbt_seed(31);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  memset(out, 0, sizeof *out);
  memset(&motion, 0, sizeof motion);
  fbt_fill(motion.v, 3, 1.0);
  fbt_fill(motion.w, 3, 1.0);
  fbt_fill(q[0], n, 0.1);
  fbt_fill(q[1], n, 0.5);
  fbt_fill(q[2], n, 2.0);
  for (int k = 0; k < n; k++) {
    state.q[place[k]] = q[0][k];
    motion.q_dot[place[k]] = q[1][k];
    motion.q_ddot[place[k]] = q[2][k];
    out->q_ddot[k] = body.reach[place[k]];
  }
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, motion.v, motion.w, motion.q_dot), FB_OK);
  FBT_INT_EQ(fb_body_energy(&body, &out->energy, &state, NULL), FB_OK);
  FBT_INT_EQ(fb_body_momentum(&body, &out->momentum, &state, NULL), FB_OK);
  for (int k = 0; k < FB_MAX_NODES; k++) {
    FBT_INT_EQ(fb_body_node_motion(&body, &out->node[k], &state, &motion, k), FB_OK);
  }
}

/* E8.1: a selection of coordinates is the body whose other coordinates are held, at every node. */
TEST(a_selection_is_the_body_with_the_others_held)
{
  int place[LARGE], own[LARGE];
  for (int stride = 1; stride < 4; stride++) { /* all, and less: the last among them */
    const int n = (LARGE + stride - 1) / stride;
    outcome whole, part;
    for (int k = 0; k < n; k++) {
      place[k] = LARGE - 1 - stride * (n - 1 - k);
      own[k] = k;
    }
    large_shape(0);
    FBT_INT_EQ(fb_shape_select(&other, &shape, place, n), FB_OK);
    FBT_INT_EQ(other.n, n);
    some_move(&whole, &shape, place, n);
    some_move(&part, &other, own, n);
    FBT_BELOW(fbt_difference((const fb_real *)&whole, (const fb_real *)&part, sizeof whole / sizeof(fb_real)),
              FBT_TOL(1e-12, 2e-4));
  }
}

/* 1, or -1 for what a mirror in the plane z = 0 turns round: z of v, x and y of w, every second coordinate (1, q)_a. */
static double mirrored_velocity(int i)
{
  return i >= 2 && i <= 4 ? -1.0 : 1.0;
}

static double mirrored_coordinate(int a)
{
  return a > 0 && a % 2 == 0 ? -1.0 : 1.0;
}

/* The cloud's first half and its mirror image, with their coordinates. kg, m, units of the coordinates. */
static void mirrored_shape(int n, double kg, double m, const double *unit)
{
  FBT_INT_EQ(fb_shape_init(&shape, n), FB_OK);
  for (int i = 0; i < PARTICLES; i++) { /* the images afterwards: what cancels does so to rounding alone */
    const int image = i >= PARTICLES / 2, k = i % (PARTICLES / 2);
    fb_real r[3], psi[3 * MAX_N], chi[3 * MAX_N * MAX_N];
    for (int x = 0; x < 3; x++) {
      const double side = image ? mirrored_velocity(x) : 1.0;
      r[x] = (fb_real)(side * m * cloud.r[k][x]);
      for (int a = 0; a < n; a++) {
        const double side_a = image ? side * mirrored_coordinate(a + 1) : 1.0;
        psi[3 * a + x] = (fb_real)(side_a * unit[a] * cloud.psi[k][a][x]);
        for (int b = 0; b < n; b++) {
          const double side_ab = image ? side_a * mirrored_coordinate(b + 1) : 1.0;
          chi[3 * (a * n + b) + x] = (fb_real)(side_ab * unit[a] * unit[b] / m * cloud.chi[k][a][b][x]);
        }
      }
    }
    FBT_INT_EQ(fb_shape_add_particle(&shape, (fb_real)(kg * cloud.m[k]), r, psi, chi), FB_OK);
  }
  for (int a = 0; a < n; a++) {
    shape.K[a * n + a] = (fb_real)(kg * unit[a] * unit[a]);
  }
}

/* What the mirror turns round is no term of the energy. */
static int may_be(int i, int j, int a, int b)
{
  return mirrored_velocity(i) * mirrored_velocity(j) * mirrored_coordinate(a) * mirrored_coordinate(b) > 0.0;
}

/* Terms of Lambda, S and M that the mirror turns round. */
static int wrong_terms(void)
{
  int wrong = 0;
  for (int k = 0; k < body.n_lambda; k++) {
    const fb_lambda_term *t = &body.lambda[k];
    wrong += !may_be(t->i, 0, t->a, t->b + 1);
  }
  for (int k = 0; k < body.n_run; k++) {
    const fb_S_run *run = &body.run[k];
    for (int ij = 0; ij < 36; ij++) {
      for (int p = run->pair; p < run->pair + run->n && fb_sym6_index(ij / 6, ij % 6) == run->i; p++) {
        wrong += !may_be(ij / 6, ij % 6, body.pair[p].a, body.pair[p].b);
      }
    }
  }
  for (int k = 0; k < body.M.n_term; k++) {
    wrong += !may_be(0, 0, body.M.term[k].a + 1, body.M.term[k].b + 1);
  }
  return wrong;
}

/* How many terms there may be: of Lambda constant and linear, of S. */
static void count_terms(int count[3], int n)
{
  memset(count, 0, 3 * sizeof *count);
  for (int k = 0; k < 36 * (n + 1) * (n + 1); k++) {
    const int i = k % 6, j = k / 6 % 6, a = k / 36 % (n + 1), b = k / 36 / (n + 1);
    count[0] += j == 0 && a == 0 && b > 0 && may_be(i, 0, a, b);
    count[1] += j == 0 && a > 0 && b > 0 && may_be(i, 0, a, b);
    count[2] += j >= i && a > 0 && b <= a && may_be(i, j, a, b);
  }
}

/* E8.4 to E8.6: what is zero by a symmetry is no term, in any unit, whichever effects are on; with all of them everything else
   is one. */
TEST(what_a_symmetry_makes_zero_is_no_term)
{
  const double far = FBT_TOL(ldexp(1.0, 30), 64.0), alike[4] = {1.0, 1.0, 1.0, 1.0};
  const double kg[] = {1.0, far, 1.0 / far, 1.0, 1.0, 1.0}, m[] = {1.0, 1.0, 1.0, far, 1.0 / far, 1.0};
  const double apart[4] = {far, 1.0, 1.0 / far, 1.0};
  particles_random(&cloud, 4, 1);
  for (int run = 0; run < FBT_COUNT(kg) * FBT_COUNT(effect_sets); run++) {
    const int in = run % FBT_COUNT(kg);
    for (int n = 2; n <= 4; n += 2) {
      fb_body_desc level;
      int count[3];
      mirrored_shape(n, kg[in], m[in], in == 5 ? apart : alike);
      memset(&level, 0, sizeof level);
      level.effects = effect_sets[run / FBT_COUNT(kg)];
      level.allow_split_effects = 1;
      FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
      FBT_INT_EQ(wrong_terms(), 0);
      count_terms(count, n);
      FBT_INT_EQ(body.n_lambda_constant, count[0]);
      if (level.effects == FB_EFFECTS_FULL) {
        FBT_INT_EQ(body.n_lambda, count[0] + count[1]);
        FBT_INT_EQ(body.n_S, count[2]);
      }
    }
  }
}

/* A beam with every coordinate that a line of so many elements has, and lumps at all its nodes, offset and skew. */
static void full_beam(void)
{
  memset(&beam_desc, 0, sizeof beam_desc);
  beam_desc.length = FB_R(2.0);
  beam_desc.n_element = LARGE / 6;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = FB_R(1.0);
  beam_desc.station[0].EA = FB_R(300.0);
  beam_desc.station[0].GJ = FB_R(20.0);
  beam_desc.station[0].EI_y = FB_R(40.0);
  beam_desc.station[0].EI_z = FB_R(70.0);
  beam_desc.station[0].i_y = FB_R(0.02);
  beam_desc.station[0].i_z = FB_R(0.03);
  beam_desc.n_lump = FB_MAX_LUMPS;
  for (int k = 0; k < FB_MAX_LUMPS; k++) {
    fb_lump *const lump = &beam_desc.lump[k];
    lump->node = k % (beam_desc.n_element + 1);
    lump->mass = FB_R(0.2);
    fbt_fill(lump->center, 3, 0.1);
    lump->inertia[0] = lump->inertia[1] = lump->inertia[2] = FB_R(0.02);
    fbt_fill(lump->inertia + 3, 3, 0.005);
  }
  beam_desc.position[1] = FB_R(0.5);
  beam_desc.attitude[0] = FB_R(0.9);
  beam_desc.attitude[3] = -FB_R(0.4);
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
}

/* That beam in its element coordinates, or in combinations of them. */
static void full_beam_body(int combined)
{
  static fb_modes_desc keep;
  static fb_body_desc level;
  static const fb_real center[3] = {FB_R(0.1), -FB_R(0.2), FB_R(0.05)}, inertia[6] = {3, 4, 5};
  int node;
  memset(&keep, 0, sizeof keep);
  memset(&level, 0, sizeof level);
  keep.basis = FB_BASIS_ELEMENTS;
  for (int kind = 0; kind < FB_KIND_COUNT; kind++) {
    keep.count[kind] = 1;
  }
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(modes.n, LARGE);
  if (combined) {
    combine(modes.shape, modes.ndof);
    combine_pairs(modes.M, 1);
    combine_pairs(modes.K, 1);
  }
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(6.0), center, inertia), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  for (int k = 1; k < FB_MAX_NODES; k++) {
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, (fb_real)(2.0 * k / (FB_MAX_NODES - 1))), FB_OK);
  }
  level.effects = FB_EFFECTS_FULL;
  level.deflection_limit = FB_R(100.0);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
}

/* What that body does, bent by a static load and turning; the strain that a gauge reads. */
static void full_beam_outcome(outcome *out)
{
  static fb_real K[LARGE * LARGE];
  const fb_real v[3] = {FB_R(0.3), -FB_R(0.2), FB_R(0.1)}, w[3] = {FB_R(0.5), FB_R(1.0), -FB_R(2.0)};
  fb_real f[LARGE], q[LARGE];
  fb_gauge gauge;
  fb_state state;
  fb_motion motion;
  for (int a = 0; a < modes.n; a++) {
    const fb_node *const tip = &shape.node[FB_MAX_NODES - 1];
    f[a] = FB_R(0.5) * tip->psi[3 * a + 1] + tip->psi[3 * a + 2] + tip->psi[3 * a] + FB_R(0.5) * tip->theta[3 * a];
  }
  memcpy(K, shape.K, sizeof K);
  FBT_INT_EQ(fb_chol_factor(K, modes.n), FB_OK);
  fb_chol_solve(q, K, f, modes.n);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  memcpy(state.q, q, sizeof(fb_real) * (size_t)modes.n);
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, w, q), FB_OK);
  memset(out, 0, sizeof *out);
  FBT_INT_EQ(fb_body_motion(&body, &motion, &state, NULL), FB_OK);
  FBT_INT_EQ(fb_body_energy(&body, &out->energy, &state, NULL), FB_OK);
  FBT_INT_EQ(fb_body_momentum(&body, &out->momentum, &state, NULL), FB_OK);
  for (int k = 0; k < FB_MAX_NODES; k++) {
    FBT_INT_EQ(fb_body_node_motion(&body, &out->node[k], &state, &motion, k), FB_OK);
    FBT_INT_EQ(fb_gauge_init(&gauge, 0, &beam, &modes, (fb_real)(2.0 * k / (FB_MAX_NODES - 1)), FB_R(0.1), FB_R(0.2)),
               FB_OK);
    out->q_ddot[k] = fb_gauge_eval(&gauge, state.q);
  }
  memcpy(out->acceleration, motion.acceleration, sizeof out->acceleration);
  memcpy(out->w_dot, motion.w_dot, sizeof out->w_dot);
}

/* E8.1 to E8.3, E8.14, E8.31: any combination of a beam's coordinates is the same body, with as many of them as there can be.
 */
TEST(combined_coordinates_of_a_beam_are_the_same_body)
{
  outcome plain, other_way;
  full_beam();
  full_beam_body(0);
  full_beam_outcome(&plain);
  full_beam_body(1);
  full_beam_outcome(&other_way);
  for (size_t i = 0; i < sizeof plain / sizeof(fb_real); i++) {
    const double a = (double)((const fb_real *)&plain)[i], b = (double)((const fb_real *)&other_way)[i];
    FBT_NEAR_ABS(a, b, FBT_TOL(1e-9, 1e-1) * (1.0 + fabs(a)));
  }
}

/* E8.8: a particle on a spring beside a heavy hub (mass m0, inertia I0, at the distance L along x) leaves the frame the hub's
   inertia alone where it moves: the largest ratio is 1 + m/m0 + m L^2/I0 of a free body, 1 + m L^2/I0 where O is held and it
   moves about an axis that is free, else 1; in any unit. */
TEST(recoil_is_what_springs_leave_the_frame)
{
  const double m0 = 3.0, I0 = 2.0, m = 0.5, L = 1.5;
  for (int run = 0; run < 4 * 3 * 3; run++) {
    const int base = run / 9, axis = run / 3 % 3;
    const double kg = ldexp(1.0, FBT_TOL(60, 10) * (run % 3 - 1)), held = axis == 0 ? 0.0 : m * L * L / I0;
    const double ratio[4] = {1.0 + m / m0 + held, 1.0, 1.0 + held, axis == 1 ? 1.0 + held : 1.0};
    const fb_real center[3] = {0}, r[3] = {(fb_real)L}, i0 = (fb_real)(I0 * kg), inertia[6] = {i0, i0, i0};
    fb_real psi[3] = {0};
    fb_body_desc level;
    memset(&level, 0, sizeof level);
    level.effects = FB_EFFECTS_LINEAR;
    level.base = (fb_base)base;
    psi[axis] = FB_R(0.7);
    FBT_INT_EQ(fb_shape_init(&shape, 1), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)(m0 * kg), center, inertia), FB_OK);
    FBT_INT_EQ(fb_shape_add_particle(&shape, (fb_real)(m * kg), r, psi, NULL), FB_OK);
    shape.K[0] = (fb_real)kg;
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
    FBT_NEAR_REL(body.recoil, sqrt(ratio[base]), FBT_TOL(1e-13, 1e-5));
    FBT_NEAR_REL(body.gyration, sqrt((1.5 * I0 + m * L * L) / (m0 + m)), FBT_TOL(1e-13, 1e-5));
  }
}

/* E8.22: two particles on a line through O have no inertia about it: refused, but for a base that holds that turn, in any
   direction and unit; with a little inertia about it they are a body. */
TEST(lines_of_particles_are_refused)
{
  for (int run = 0; run < 60; run++) {
    const double kg = ldexp(1.0, FBT_TOL(60, 10) * (run % 3 - 1));
    fb_real r[3], inertia[6] = {0};
    fb_body_desc level;
    int along_z;
    memset(&level, 0, sizeof level);
    for (int i = 0; i < 3; i++) { /* along an axis, in a plane, in space; whole numbers: their inertia is exact */
      r[i] = run % 5 < 2 && (run / 5 + i) % 3 < 2 - run % 5 ? FB_R(0.0) : (fb_real)floor(4.0 * fbt_random() + 0.5);
      inertia[i] = (fb_real)(0.01 * kg);
    }
    r[run / 5 % 3] += run % 5 == 0 || fbt_largest(r, 3) == 0.0 ? FB_R(8.0) : FB_R(0.0);
    along_z = r[0] == FB_R(0.0) && r[1] == FB_R(0.0);
    FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
    FBT_INT_EQ(fb_shape_add_particle(&shape, (fb_real)kg, r, NULL, NULL), FB_OK);
    for (int i = 0; i < 3; i++) {
      r[i] *= -FB_R(2.0);
    }
    FBT_INT_EQ(fb_shape_add_particle(&shape, (fb_real)kg, r, NULL, NULL), FB_OK);
    for (int more = 0; more < 2; more++) {
      const fb_status expected[4] = {FB_ERR_SINGULAR, FB_OK, FB_ERR_SINGULAR, along_z ? FB_ERR_SINGULAR : FB_OK};
      for (int base = 0; base < 4; base++) {
        level.base = (fb_base)base;
        FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), more ? FB_OK : expected[base]);
      }
      FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)kg, r, inertia), FB_OK);
    }
  }
}

/* E8.22, E8.19: a free body with the reactions of its base as loads at O moves as the held one does. */
TEST(a_held_body_is_a_free_one_with_its_reactions)
{
  static const fb_base base[] = {FB_BASE_PINNED, FB_BASE_HINGED};
  int node[2];
  for (int k = 0; k < 2; k++) {
    fb_state held, loose;
    fb_motion motion, free_motion;
    fb_input input;
    fb_real qd[BOOM_MODES], v[3], w[3];
    boom_body(FB_EFFECTS_FULL | FB_EFFECT_GRAVITY, base[k], node);
    boom_state(&held, 0.05);
    memset(&input, 0, sizeof input);
    input.n_load = 1;
    input.load[0].node = node[0];
    fbt_fill(input.load[0].force, 3, 2.0);
    FBT_INT_EQ(fb_body_motion(&body, &motion, &held, &input), FB_OK);
    FBT_TRUE(fbt_largest(motion.reaction_force, 3) > 0.1 && fbt_largest(motion.acceleration, 3) == 0.0);
    FBT_TRUE((fbt_largest(motion.reaction_torque, 3) > 0.1) == (base[k] == FB_BASE_HINGED));
    FBT_TRUE(motion.reaction_torque[2] == FB_R(0.0)); /* what is free has none, not even rounding */
    FBT_TRUE((fbt_largest(motion.reaction_torque, 2) == 0.0) == (base[k] == FB_BASE_PINNED));
    boom_body(FB_EFFECTS_FULL | FB_EFFECT_GRAVITY, FB_BASE_FREE, node);
    loose = held;
    memcpy(v, motion.v, sizeof v);
    memcpy(w, motion.w, sizeof w);
    memcpy(qd, motion.q_dot, sizeof qd);
    FBT_INT_EQ(fb_state_from_velocity(&body, &loose, v, w, qd), FB_OK);
    input.n_load = 2;
    input.load[1].axes = FB_AXES_BODY;
    memcpy(input.load[1].force, motion.reaction_force, sizeof input.load[1].force);
    memcpy(input.load[1].torque, motion.reaction_torque, sizeof input.load[1].torque);
    FBT_INT_EQ(fb_body_motion(&body, &free_motion, &loose, &input), FB_OK);
    FBT_TRUE(fbt_largest(free_motion.reaction_force, 3) == 0.0 && fbt_largest(free_motion.reaction_torque, 3) == 0.0);
    FBT_BELOW(fbt_difference(free_motion.acceleration, motion.acceleration, 3), FBT_TOL(1e-12, 1e-3));
    FBT_BELOW(fbt_difference(free_motion.w_dot, motion.w_dot, 3), FBT_TOL(1e-12, 1e-3));
    FBT_BELOW(fbt_difference(free_motion.q_ddot, motion.q_ddot, BOOM_MODES), FBT_TOL(1e-11, 1e-2));
  }
}

/* E8.22: a rigid pendulum from 1 rad is at the bottom after a quarter of 2 pi / (omega_0 agm(1, cos 1/2)); pinned and
   hinged. */
TEST(pinned_and_hinged_bodies_swing_as_rigid_pendulums)
{
  static const fb_real center[3] = {FB_R(0.5), 0, 0}, inertia[6] = {FB_R(0.1), FB_R(0.2), FB_R(0.25)};
  const double start = 1.0, J = 0.25 + 2.0 * 0.25, omega = sqrt(2.0 * 9.0 * 0.5 / J);
  double a = 1.0, g = cos(0.5 * start), quarter;
  for (int k = 0; k < 6; k++) {
    const double mean = 0.5 * (a + g);
    g = sqrt(a * g);
    a = mean;
  }
  quarter = 0.5 * 3.14159265358979323846 / (omega * a);
  for (int k = 0; k < 2; k++) {
    static fb_body_desc desc;
    fb_state state;
    fb_rk4_work work;
    fb_motion motion;
    const fb_real turn[3] = {0, 0, (fb_real)start};
    memset(&desc, 0, sizeof desc);
    desc.base = k ? FB_BASE_PINNED : FB_BASE_HINGED;
    desc.effects = FB_EFFECT_GRAVITY;
    desc.gravity[0] = FB_R(9.0);
    FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(2.0), center, inertia), FB_OK);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    fb_quat_from_rotvec(state.quat, turn);
    for (int i = 0; i < 1000; i++) {
      FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, (fb_real)(quarter / 1000.0)), FB_OK);
    }
    FBT_INT_EQ(fb_body_motion(&body, &motion, &state, NULL), FB_OK);
    FBT_NEAR_ABS(state.quat[3], 0.0, FBT_TOL(1e-12, 1e-5));
    FBT_NEAR_REL(motion.w[2], -2.0 * omega * sin(0.5 * start), FBT_TOL(1e-11, 1e-5));
    FBT_NEAR_REL(motion.reaction_force[0], -(2.0 * 9.0 + 2.0 * 0.5 * pow(2.0 * omega * sin(0.5 * start), 2.0)),
                 FBT_TOL(1e-11, 1e-5));
    { /* a velocity that the base holds is refused */
      const fb_real v[3] = {0, 1, 0}, w[3] = {1, 0, 0}, none[3] = {0};
      FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, none, NULL), FB_ERR_VALUE);
      FBT_INT_EQ(fb_state_from_velocity(&body, &state, none, w, NULL), k ? FB_OK : FB_ERR_VALUE);
    }
  }
}

/* Defects of velocity, acceleration, angular rate and angular acceleration of a node at the middle of two rk4 steps of
   h against central differences of its pose (and rate). */
static void node_defects(double defect[4], double h, int node)
{
  fb_state state;
  fb_rk4_work work;
  fb_motion motion;
  fb_node_motion at[3];
  fb_real turn[4], spin[3];
  boom_state(&state, 0.02);
  for (int k = 0; k < 40; k++) { /* so that the middle is at 0.1 s for every h */
    FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, (fb_real)((0.1 - h) / 40.0)), FB_OK);
  }
  for (int k = 0; k < 3; k++) {
    FBT_INT_EQ(fb_body_motion(&body, &motion, &state, NULL), FB_OK);
    FBT_INT_EQ(fb_body_node_motion(&body, &at[k], &state, &motion, node), FB_OK);
    FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, (fb_real)h), FB_OK);
  }
  {
    const fb_real back[4] = {at[0].quat[0], -at[0].quat[1], -at[0].quat[2], -at[0].quat[3]};
    fb_quat_mul(turn, at[2].quat, back);
    fb_quat_to_rotvec(spin, turn);
  }
  memset(defect, 0, 4 * sizeof defect[0]);
  for (int i = 0; i < 3; i++) {
    const double x0 = (double)at[0].position[i], x1 = (double)at[1].position[i], x2 = (double)at[2].position[i];
    const double dw = (double)at[2].angular_rate[i] - (double)at[0].angular_rate[i];
    defect[0] = fmax(defect[0], fabs((x2 - x0) / (2.0 * h) - (double)at[1].velocity[i]));
    defect[1] = fmax(defect[1], fabs((x2 - 2.0 * x1 + x0) / (h * h) - (double)at[1].acceleration[i]));
    defect[2] = fmax(defect[2], fabs((double)spin[i] / (2.0 * h) - (double)at[1].angular_rate[i]));
    defect[3] = fmax(defect[3], fabs(dw / (2.0 * h) - (double)at[1].angular_acceleration[i]));
  }
}

/* Section 8: what limits a deflection: how far out the farthest particle is, and how far each mode moves the one that it
   moves most. */
TEST(size_and_reach_are_those_of_the_particles)
{
  static const fb_real center[3] = {3, 4, 12}, inertia[6] = {1, 1, 1};
  const int n = 5;
  fb_body_desc level;
  fb_state state;
  double size = 0.0, reach[MAX_N] = {0.0};
  particles_random(&cloud, n, 1);
  particles_to_shape(&shape, &cloud);
  for (int i = 0; i < PARTICLES; i++) {
    const double *r = cloud.r[i];
    size = fmax(size, sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]));
    for (int a = 0; a < n; a++) {
      const double *x = cloud.psi[i][a];
      reach[a] = fmax(reach[a], sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]));
    }
  }
  FBT_NEAR_REL(shape.size, size, FBT_TOL(1e-14, 1e-6));
  for (int a = 0; a < n; a++) {
    FBT_NEAR_REL(shape.reach[a], reach[a], FBT_TOL(1e-14, 1e-6));
  }
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(1.0), center, inertia), FB_OK); /* 13 m away */
  memset(&level, 0, sizeof level);
  level.effects = FB_EFFECTS_FULL;
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
  FBT_NEAR_REL(shape.size, 13.0, FBT_TOL(1e-14, 1e-6));
  FBT_NEAR_REL(body.deflection_limit, 6.5, FBT_TOL(1e-14, 1e-6)); /* half of it */
  FBT_TRUE(memcmp(body.reach, shape.reach, sizeof(fb_real) * (size_t)n) == 0);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  for (int k = 0; k < n; k++) { /* of any two what they may have together, with either sign */
    const int next = (k + 1) % n;
    state.q[k] = FB_R(0.45) * body.deflection_limit / body.reach[k];
    state.q[next] = -FB_R(0.45) * body.deflection_limit / body.reach[next];
    FBT_INT_EQ(fb_state_check(&body, &state), FB_OK);
    state.q[k] *= FB_R(1.25);
    FBT_INT_EQ(fb_state_check(&body, &state), FB_ERR_RANGE);
    state.q[k] = state.q[next] = FB_R(0.0);
  }
}

/* E8.16, E8.21: the energy of gravity is that of the particles in their places, and so is that of the strain, whatever else
   moves; without gravity there is none. */
TEST(potential_energies_agree_with_a_particle_model)
{
  const int n = 5;
  particles_random(&cloud, n, 1);
  particles_to_shape(&shape, &cloud);
  fbt_fill(shape.K, n * n, 0.5);
  for (int ab = 0; ab < n * n; ab++) {
    const int ba = ab % n * n + ab / n;
    shape.K[ab] = ab == ba ? FB_R(5.0) : ab > ba ? shape.K[ba] : shape.K[ab];
  }
  for (int falls = 0; falls < 2; falls++) {
    double gravity = 0.0, strain = 0.0;
    fb_body_desc level;
    fb_state state;
    fb_energy energy;
    velocity s;
    fb_real R[9];
    memset(&level, 0, sizeof level);
    level.effects = FB_EFFECTS_FULL | (falls ? FB_EFFECT_GRAVITY : 0);
    fbt_fill(level.gravity, 3, 5.0);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
    velocity_random(&s, n, 0.1);
    state_from(&state, &body, &s);
    fbt_fill(state.rho, 3, 2.0);
    fbt_fill(state.quat, 4, 1.0);
    FBT_INT_EQ(fb_quat_normalize(state.quat), FB_OK);
    fb_quat_to_mat33(R, state.quat);
    for (int i = 0; i < PARTICLES; i++) {
      double x[3], J[MAX_N][3], xd[3];
      particle_at(x, J, xd, &cloud, i, &s);
      for (int k = 0; k < 3; k++) {
        const double at =
            (double)state.rho[k] + (double)R[3 * k] * x[0] + (double)R[3 * k + 1] * x[1] + (double)R[3 * k + 2] * x[2];
        gravity -= falls * cloud.m[i] * (double)level.gravity[k] * at;
      }
    }
    for (int ab = 0; ab < n * n; ab++) {
      strain += 0.5 * s.q[ab / n] * (double)shape.K[ab] * s.q[ab % n];
    }
    FBT_INT_EQ(fb_body_energy(&body, &energy, &state, NULL), FB_OK);
    FBT_NEAR_ABS(energy.gravity, gravity, FBT_TOL(1e-11, 1e-2));
    FBT_NEAR_ABS(energy.strain, strain, FBT_TOL(1e-14, 1e-6));
  }
}

/* E8.7: a particle on a spring: the damping force is 2 zeta sqrt(k m) times its speed, soft or stiff, in any unit of its
   coordinate. */
TEST(damping_is_that_of_a_particle_on_a_spring)
{
  for (int run = 0; run < 9; run++) {
    const double k = pow(10.0, 3.0 * (run % 3 - 1)), m = run / 3 == 0 ? 1.0 : 0.01 * run, zeta = 0.05;
    const fb_real r[3] = {0}, psi[3] = {0, 1}, none[3] = {0}, q_dot = FB_R(2.0);
    fb_body_desc level;
    fb_state state, rate;
    memset(&level, 0, sizeof level);
    level.effects = FB_EFFECTS_LINEAR | FB_EFFECT_DAMPING;
    level.base = FB_BASE_PRESCRIBED;
    level.zeta[0] = (fb_real)zeta;
    FBT_INT_EQ(fb_shape_init(&shape, 1), FB_OK);
    FBT_INT_EQ(fb_shape_add_particle(&shape, (fb_real)m, r, psi, NULL), FB_OK);
    shape.K[0] = (fb_real)k;
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_state_from_velocity(&body, &state, none, none, &q_dot), FB_OK);
    FBT_INT_EQ(fb_body_rates(&body, &rate, &state, NULL), FB_OK);
    FBT_NEAR_REL(rate.pi[0], -2.0 * zeta * sqrt(k * m) * 2.0, FBT_TOL(1e-13, 1e-5));
    FBT_NEAR_REL(body.limit_damping, 2.0 * zeta * sqrt(k / m), FBT_TOL(1e-13, 1e-5));
    FBT_NEAR_REL(body.limit_elastic, k / m, FBT_TOL(1e-13, 1e-5));
  }
}

/* A pair's integrals go to both its places, a coordinate's with itself to its own, once; what is not given is none. */
TEST(integrals_of_a_pair_stand_in_both_places)
{
  for (int k = 0; k < 3 * 4; k++) {
    const int n = 3, a = k % 4 < 3 ? k % 3 : 1, b = k % 4 < 3 ? (k + 1) % 3 : 1, which = k / 4;
    fb_real p[3], h[3], G[9];
    FBT_INT_EQ(fb_shape_init(&shape, n), FB_OK);
    fbt_fill(p, 3, 1.0);
    fbt_fill(h, 3, 1.0);
    fbt_fill(G, 9, 1.0);
    FBT_INT_EQ(fb_shape_add_pair(&shape, a, b, which == 0 ? p : NULL, which == 1 ? h : NULL, which == 2 ? G : NULL),
               FB_OK);
    for (int ij = 0; ij < n * n; ij++) {
      const int here = ij == a * n + b || ij == b * n + a;
      for (int x = 0; x < 9; x++) {
        FBT_TRUE(shape.pchi[3 * ij + x % 3] == (here && which == 0 ? p[x % 3] : FB_R(0.0)));
        FBT_TRUE(shape.hchi[3 * ij + x % 3] == (here && which == 1 ? h[x % 3] : FB_R(0.0)));
        FBT_TRUE(shape.Gamchi[9 * ij + x] == (here && which == 2 ? G[x] : FB_R(0.0)));
      }
    }
  }
}

/* Particles with as many nodes as there can be, all that they have random, and the body of it. */
static void random_nodes(int n)
{
  fb_body_desc desc;
  memset(&desc, 0, sizeof desc);
  desc.effects = FB_EFFECTS_FULL;
  particles_random(&cloud, n, 1);
  particles_to_shape(&shape, &cloud);
  shape.n_node = FB_MAX_NODES;
  for (int k = 0; k < FB_MAX_NODES; k++) {
    fb_node *at = &shape.node[k];
    fbt_fill(at->r, 3, 1.0);
    fbt_fill(at->psi, 3 * n, 1.0);
    fbt_fill(at->theta, 3 * n, 1.0);
    fbt_fill(at->chi, 3 * n * (n + 1) / 2, 1.0);
    fbt_fill(at->chi_theta, 3 * n * (n + 1) / 2, 1.0);
  }
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
}

/* E8.14: a body's nodes are those of its shape, every number of them. */
TEST(nodes_are_those_of_the_shape)
{
  const int n = 3, pairs = 3 * n * (n + 1) / 2;
  random_nodes(n);
  FBT_INT_EQ(body.n_node, FB_MAX_NODES);
  for (int k = 0; k < FB_MAX_NODES; k++) {
    const fb_node *at = &body.node[k], *from = &shape.node[k];
    FBT_TRUE(fbt_difference(at->r, from->r, 3) == 0.0);
    FBT_TRUE(fbt_difference(at->psi, from->psi, 3 * n) == 0.0);
    FBT_TRUE(fbt_difference(at->theta, from->theta, 3 * n) == 0.0);
    FBT_TRUE(fbt_difference(at->chi, from->chi, pairs) == 0.0);
    FBT_TRUE(fbt_difference(at->chi_theta, from->chi_theta, pairs) == 0.0);
  }
}

/* E8.14, E8.20, E8.30: of nodes that turn by a radian and more, on a frame that stands still, velocity and acceleration
   are the differences of position and velocity, angular rate and acceleration those of attitude and angular rate. */
TEST(nodes_that_turn_far_have_the_rates_of_their_pose)
{
  const int n = 3;
  const double h = FBT_TOL(1e-4, 1e-2);
  double turned = 0.0;
  random_nodes(n);
  for (int node = 1; node < FB_MAX_NODES; node++) {
    fb_node_motion at[3];
    fb_real back[4], turn[4], spin[3];
    fb_motion motion;
    fb_state state;
    memset(&motion, 0, sizeof motion);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    fbt_fill(state.q, n, 0.7);
    fbt_fill(motion.q_dot, n, 0.7);
    fbt_fill(motion.q_ddot, n, 0.7);
    for (int k = 0; k < 3; k++) {
      fb_state then = state;
      fb_motion moves = motion;
      for (int a = 0; a < n; a++) {
        const double t = (k - 1) * h;
        then.q[a] += (fb_real)(t * (double)motion.q_dot[a] + 0.5 * t * t * (double)motion.q_ddot[a]);
        moves.q_dot[a] += (fb_real)(t * (double)motion.q_ddot[a]);
      }
      FBT_INT_EQ(fb_body_node_motion(&body, &at[k], &then, &moves, node), FB_OK);
    }
    for (int i = 0; i < 4; i++) {
      back[i] = i ? -at[0].quat[i] : at[0].quat[0];
    }
    fb_quat_mul(turn, at[2].quat, back);
    fb_quat_to_rotvec(spin, turn);
    turned = fmax(turned, fbt_largest(at[1].rotation, 3));
    for (int i = 0; i < 3; i++) {
      const double v = (double)(at[2].position[i] - at[0].position[i]),
                   a = (double)(at[2].velocity[i] - at[0].velocity[i]);
      const double w_dot = (double)(at[2].angular_rate[i] - at[0].angular_rate[i]);
      FBT_NEAR_ABS(at[1].velocity[i], v / (2.0 * h), FBT_TOL(1e-6, 3e-3));
      FBT_NEAR_ABS(at[1].acceleration[i], a / (2.0 * h), FBT_TOL(1e-6, 3e-3));
      FBT_NEAR_ABS(at[1].angular_rate[i], (double)spin[i] / (2.0 * h), FBT_TOL(1e-6, 3e-3));
      FBT_NEAR_ABS(at[1].angular_acceleration[i], w_dot / (2.0 * h), FBT_TOL(1e-6, 3e-3));
    }
  }
  FBT_TRUE(turned > 1.0);
}

/* E8.14, E8.20. The attitude of a node is exact to second degree of the deflection, its rate to first. */
TEST(node_kinematics_match_finite_differences)
{
  int node[2];
  boom_body(FB_EFFECTS_FULL | FB_EFFECT_GRAVITY | FB_EFFECT_DAMPING, FB_BASE_FREE, node);
  for (int k = 0; k < 3; k++) {
    double coarse[4], fine[4];
    const int which = k ? node[k - 1] : 0;
    fbt_seed(7);
    node_defects(coarse, FBT_TOL(2e-3, 4e-2), which);
    fbt_seed(7);
    node_defects(fine, FBT_TOL(1e-3, 2e-2), which);
    FBT_BELOW(fine[0], FBT_TOL(1e-4, 2e-2));
    FBT_BELOW(fine[1], FBT_TOL(5e-4, 0.2)); /* steps of which the square is 400 times as large */
    FBT_BELOW(fine[2], FBT_TOL(2e-3, 5e-2));
    FBT_BELOW(fine[3], FBT_TOL(3e-3, 1.0));
    if (!FB_SINGLE) {
      FBT_NEAR_ABS(coarse[0] / fine[0], 4.0, 1.0);
      FBT_NEAR_ABS(coarse[1] / fine[1], 4.0, 1.0);
    }
  }
}

/* E8.19: force and torque of a prescribed base are the rates of momentum about the moving origin, less gravity and
   loads. */
TEST(reactions_balance_the_momentum)
{
  int node[2];
  const double h = FBT_TOL(1e-4, 2e-3);
  fb_state state;
  fb_rk4_work work;
  fb_motion motion;
  fb_momentum momentum[2];
  fb_input input[3];
  fb_real R[9], F[3], T[3], rate[3], gravity[3] = {FB_R(0.3), 0, -FB_R(1.5)}, load[3];
  fb_node_motion at;
  fb_state center_state;
  boom_body(FB_EFFECTS_FULL | FB_EFFECT_GRAVITY, FB_BASE_PRESCRIBED, node);
  boom_state(&state, 0.05);
  memset(&center_state, 0, sizeof center_state);
  memset(input, 0, sizeof input);
  for (int k = 0; k < 3; k++) { /* v = v0 + t v_dot at t = -h, 0, h */
    for (int i = 0; i < 3; i++) {
      input[k].v_dot[i] = (fb_real)(0.4 - 0.3 * i);
      input[k].w_dot[i] = (fb_real)(0.2 * i - 0.3);
      input[k].v[i] = (fb_real)(0.5 * i) + (fb_real)((k - 1) * h) * input[k].v_dot[i];
      input[k].w[i] = (fb_real)(0.7 - 0.2 * i) + (fb_real)((k - 1) * h) * input[k].w_dot[i];
    }
    input[k].n_load = 1;
    input[k].load[0].node = node[0];
    input[k].load[0].force[0] = FB_R(0.7);
    input[k].load[0].force[1] = -FB_R(0.4);
    input[k].load[0].torque[2] = FB_R(0.1);
  }
  FBT_INT_EQ(fb_body_momentum(&body, &momentum[0], &state, &input[0]), FB_OK);
  {
    fb_input half[3]; /* two steps of h: ends and middles of the motion */
    for (int s = 0; s < 2; s++) {
      half[0] = input[s];
      half[2] = input[s + 1];
      half[1] = input[s];
      for (int i = 0; i < 3; i++) {
        half[1].v[i] = FB_R(0.5) * (half[0].v[i] + half[2].v[i]);
        half[1].w[i] = FB_R(0.5) * (half[0].w[i] + half[2].w[i]);
      }
      if (s == 1) {
        center_state = state;
        FBT_INT_EQ(fb_body_motion(&body, &motion, &state, &input[1]), FB_OK);
        FBT_INT_EQ(fb_body_node_motion(&body, &at, &state, &motion, node[0]), FB_OK);
        fb_quat_to_mat33(R, state.quat);
        fb_mat33_mul_vec3(F, R, motion.reaction_force);
        fb_mat33_mul_vec3(T, R, motion.reaction_torque);
        fb_vec3_cross(load, state.rho, F);
        for (int i = 0; i < 3; i++) { /* about the inertial origin */
          T[i] += load[i];
          F[i] += body.mass * gravity[i] + input[1].load[0].force[i];
        }
        fb_vec3_cross(load, at.position, input[1].load[0].force);
        for (int i = 0; i < 3; i++) {
          T[i] += load[i] + input[1].load[0].torque[i];
        }
      }
      FBT_INT_EQ(fb_rk4_step(&body, &state, &work, &half[0], &half[1], &half[2], (fb_real)h), FB_OK);
    }
  }
  FBT_INT_EQ(fb_body_momentum(&body, &momentum[1], &state, &input[2]), FB_OK);
  for (int i = 0; i < 3; i++) {
    rate[i] = (momentum[1].linear[i] - momentum[0].linear[i]) / (fb_real)(2.0 * h);
  }
  FBT_BELOW(fbt_difference(rate, F, 3), FBT_TOL(1e-4, 0.2));
  /* the torque of gravity about the inertial origin, from its energy */
  {
    fb_energy up, down;
    for (int i = 0; i < 3; i++) { /* -dV/d(angle) about inertial axis i */
      fb_state turned[2];
      for (int s = 0; s < 2; s++) {
        fb_real phi[3] = {0}, quat[4], Q[9];
        turned[s] = center_state;
        phi[i] = s ? FBT_TOL(FB_R(1e-4), FB_R(1e-2)) : -FBT_TOL(FB_R(1e-4), FB_R(1e-2));
        fb_quat_from_rotvec(quat, phi);
        fb_quat_mul(turned[s].quat, quat, center_state.quat);
        fb_quat_to_mat33(Q, quat);
        fb_mat33_mul_vec3(turned[s].rho, Q, center_state.rho);
      }
      FBT_INT_EQ(fb_body_energy(&body, &down, &turned[0], &input[1]), FB_OK);
      FBT_INT_EQ(fb_body_energy(&body, &up, &turned[1], &input[1]), FB_OK);
      T[i] -= (up.gravity - down.gravity) / FBT_TOL(FB_R(2e-4), FB_R(2e-2));
      rate[i] = (momentum[1].angular[i] - momentum[0].angular[i]) / (fb_real)(2.0 * h);
    }
  }
  FBT_BELOW(fbt_difference(rate, T, 3), FBT_TOL(2e-4, 5e-2));
}

/* E8.16: in free fall from rest nothing bends, and the fall is g t^2 / 2; with any attitude. */
TEST(a_falling_body_does_not_deform)
{
  int node[2];
  fb_state state;
  fb_rk4_work work;
  boom_body(FB_EFFECTS_FULL | FB_EFFECT_GRAVITY | FB_EFFECT_DAMPING, FB_BASE_FREE, node);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  fbt_fill(state.quat, 4, 1.0);
  FBT_INT_EQ(fb_quat_normalize(state.quat), FB_OK);
  for (int k = 0; k < 1000; k++) {
    FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, FB_R(0.002)), FB_OK);
  }
  FBT_BELOW(fbt_largest(state.q, BOOM_MODES), FBT_TOL(1e-12, 1e-4));
  FBT_NEAR_ABS(state.rho[2], -0.5 * 1.5 * 4.0, FBT_TOL(1e-11, 1e-4));
  FBT_NEAR_ABS(state.rho[0], 0.5 * 0.3 * 4.0, FBT_TOL(1e-11, 1e-4));
}

/* Difference of the elastic response after 1 s between a motion and the same one in a turned and displaced frame that
   moves with the speed drift. */
static double frame_difference(double speed, double dt)
{
  fb_state state[2];
  fb_rk4_work work;
  fb_input input[2];
  fb_motion motion;
  fb_real turn[4], Q[9], R[9], drift[3], v[3];
  boom_state(&state[0], 0.1);
  state[1] = state[0];
  fbt_fill(turn, 4, 1.0);
  fbt_fill(drift, 3, speed);
  FBT_INT_EQ(fb_quat_normalize(turn), FB_OK);
  fb_quat_to_mat33(Q, turn);
  fb_quat_mul(state[1].quat, turn, state[0].quat);
  fb_mat33_mul_vec3(state[1].rho, Q, state[0].rho);
  state[1].rho[1] += FB_R(5.0);
  FBT_INT_EQ(fb_body_motion(&body, &motion, &state[0], NULL), FB_OK);
  fb_quat_to_mat33(R, state[1].quat);
  fb_mat33_mulT_vec3(v, R, drift);
  for (int i = 0; i < 3; i++) {
    v[i] += motion.v[i];
  }
  FBT_INT_EQ(fb_state_from_velocity(&body, &state[1], v, motion.w, motion.q_dot), FB_OK);
  memset(input, 0, sizeof input);
  input[0].n_load = 1;
  input[0].load[0].node = 1;
  fbt_fill(input[0].load[0].force, 3, 0.5);
  input[1] = input[0];
  fb_mat33_mul_vec3(input[1].load[0].force, Q, input[0].load[0].force); /* dead load: turned with the frame */
  for (int k = 0; k < (int)(1.0 / dt + 0.5); k++) {
    for (int f = 0; f < 2; f++) {
      FBT_INT_EQ(fb_rk4_step(&body, &state[f], &work, &input[f], &input[f], &input[f], (fb_real)dt), FB_OK);
    }
  }
  FBT_TRUE(fbt_largest(state[0].q, BOOM_MODES) > 0.01);
  return fbt_difference(state[0].q, state[1].q, BOOM_MODES);
}

/* E8.13 to E8.18: in a turned and displaced frame the elastic response is the same to rounding with any step; in one
   that moves, to the truncation error of the scheme, which at a small step is rounding, too. */
TEST(elastic_response_is_frame_indifferent)
{
  int node[2];
  double coarse, fine;
  boom_body(FB_EFFECTS_FULL | FB_EFFECT_DAMPING, FB_BASE_FREE, node);
  fbt_seed(3);
  FBT_BELOW(frame_difference(0.0, 0.01), FBT_TOL(1e-13, 1e-4));
  fbt_seed(3);
  coarse = frame_difference(3.0, 0.002);
  fbt_seed(3);
  fine = frame_difference(3.0, 0.00025);
  fbt_figure("elastic response in a turned, moving frame", "frame indifference", fine);
  FBT_BELOW(fine, FBT_TOL(3e-13, 1e-3));
  FBT_BELOW(coarse, FBT_TOL(1e-9, 1e-3));
}

/* E8.7: free decay of one mode of a held body: the peaks fall by exp(-2 pi zeta / sqrt(1 - zeta^2)); with
   finite-element coordinates (full M) the same. */
TEST(damped_free_decay_has_the_given_ratio)
{
  static fb_modes_desc keep;
  static fb_body_desc desc;
  int node[2];
  keep.basis = FB_BASIS_ELEMENTS;
  keep.count[FB_KIND_BEND_Y] = 1;
  boom(&shape, node);
  for (int full = 0; full < 2; full++) {
    fb_state state;
    fb_rk4_work work;
    double zeta, omega, t;
    const int steps = 4000;
    if (full) {
      beam_desc.n_element = 3;
      beam_desc.n_lump = 0;
      FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
      FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
      FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
      FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
    }
    memset(&desc, 0, sizeof desc);
    desc.effects = FB_EFFECTS_LINEAR | FB_EFFECT_DAMPING;
    desc.base = FB_BASE_PRESCRIBED;
    for (int k = 0; k < shape.n; k++) {
      desc.zeta[k] = FB_R(0.05);
    }
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
    FBT_INT_EQ(body.unit_mass && body.K.n_term == 0, !full);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    if (full) { /* along the first eigenvector */
      static fb_real K[FB_MAX_MODES * FB_MAX_MODES], M[FB_MAX_MODES * FB_MAX_MODES], X[FB_MAX_MODES * FB_MAX_MODES];
      fb_real d[FB_MAX_MODES];
      memcpy(K, shape.K, sizeof K);
      memcpy(M, shape.M, sizeof M);
      FBT_INT_EQ(fb_eig_gen_solve(d, X, K, M, shape.n), FB_OK);
      omega = sqrt((double)d[0]);
      for (int a = 0; a < shape.n; a++) {
        state.q[a] = FB_R(0.1) * X[a];
      }
    } else {
      omega = (double)modes.omega[0];
      state.q[0] = FB_R(0.1);
    }
    zeta = 0.05;
    t = 2.0 * 3.14159265358979324 / (omega * sqrt(1.0 - zeta * zeta)); /* one damped period from rest: a peak again */
    {
      const fb_real before = state.q[0];
      for (int k = 0; k < steps; k++) {
        FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, (fb_real)(t / steps)), FB_OK);
      }
      FBT_NEAR_REL(state.q[0] / before, exp(-zeta * omega * t), FBT_TOL(1e-9, 1e-3));
    }
  }
}

/* Unit cantilever, uniform or of half the height at the tip: mass h, EI h^3; the cubic lies above its chords by 1/8 of
   its curvature, which the station values give back on average. */
static void rotor_blade(int tapered)
{
  const double chord = 1.0 / (FB_MAX_STATIONS - 1);
  memset(&beam_desc, 0, sizeof beam_desc);
  beam_desc.length = FB_R(1.0);
  beam_desc.n_element = 10;
  beam_desc.n_station = tapered ? FB_MAX_STATIONS : 1;
  for (int k = 0; k < beam_desc.n_station; k++) {
    const double x = tapered ? k * chord : 0.0, h = 1.0 - 0.5 * x, cut = tapered ? chord * chord / 8.0 : 0.0;
    fb_section *st = &beam_desc.station[k];
    st->x = (fb_real)x;
    st->mass = (fb_real)h;
    st->EI_y = st->EI_z = (fb_real)(h * (h * h - cut));
  }
}

/* Worst relative error of the first flap and lag frequencies for eta = 0..12 and three hub radii: eight bending modes,
   one body for all spins; stiffness about the steady spin by exact differences. */
static double spinning_error(const char *file, int tapered)
{
  const fbt_table *table = fbt_reference(file);
  static const double radius[] = {0.0, 0.1, 1.0};
  static fb_body_desc desc;
  fb_modes_desc keep;
  double worst = 0.0;
  for (int r = 0; r < FBT_COUNT(radius); r++) {
    rotor_blade(tapered);
    beam_desc.position[0] = (fb_real)radius[r];
    memset(&desc, 0, sizeof desc);
    desc.effects = FB_EFFECTS_FULL;
    desc.base = FB_BASE_PRESCRIBED;
    memset(&keep, 0, sizeof keep);
    keep.spin = FB_R(12.0);
    keep.spin_radius = (fb_real)radius[r];
    FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
    for (int plane = 0; plane < 2; plane++) { /* the axis of spin is z: y is lag, z is flap */
      keep.count[FB_KIND_BEND_Y] = plane ? 0 : 8;
      keep.count[FB_KIND_BEND_Z] = plane ? 8 : 0;
      FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
      FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
      FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
      FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
      for (int row = 0; row < table->rows; row++) {
        const double eta = fbt_value(table, row, "eta");
        fb_real K[64], V[64], omega2[8];
        fb_input input;
        if (fbt_value(table, row, "alpha") != radius[r] || eta > 12.0 || fbt_value(table, row, "mode") != 1.0) {
          continue;
        }
        memset(&input, 0, sizeof input);
        input.w[2] = (fb_real)eta;
        for (int b = 0; b < 8; b++) {
          fb_state state, rate[2];
          for (int side = 0; side < 2; side++) {
            FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
            state.q[b] = side ? FB_R(0.5) : -FB_R(0.5);
            FBT_INT_EQ(fb_state_from_velocity(&body, &state, input.v, input.w, NULL), FB_OK);
            FBT_INT_EQ(fb_body_rates(&body, &rate[side], &state, &input), FB_OK);
          }
          for (int a = 0; a < 8; a++) {
            K[a * 8 + b] = rate[0].pi[a] - rate[1].pi[a];
          }
        }
        FBT_INT_EQ(fb_eig_sym_solve(omega2, V, K, 8), FB_OK);
        {
          const double error =
              fabs(sqrt((double)omega2[0]) / fbt_value(table, row, plane ? "mu_flap" : "mu_lag") - 1.0);
          worst = fmax(worst, error);
        }
      }
    }
  }
  return worst;
}

/* E8.2, E8.12, E7.4, E6.6: rotating cantilevers (Wright et al. 1982; Hodges and Rutkowski 1981;
   tests/reference/p02). */
TEST(spinning_beams_stiffen_as_published)
{
  const double uniform = spinning_error("p02_rotating_uniform.csv", 0);
  const double tapered = spinning_error("p02_rotating_tapered.csv", 1);
  fbt_figure("rotating cantilever, first flap and lag, eta 0..12", "power series (p02; Wright et al. 1982)", uniform);
  fbt_figure("the same, tapered", "power series (p02; Hodges and Rutkowski 1981)", tapered);
  FBT_BELOW(uniform, FBT_TOL(1e-6, 2e-3));
  FBT_BELOW(tapered, FBT_TOL(1e-5, 2e-3));
}

/* Worst relative error of the first four flap and lag frequencies, eta = 0..50 and three hub radii, of the eigenvalues of
   the linear model about the steady spin: 20 bending modes of 20 elements (the mesh errs by 1e-6 at eta = 50), one body
   for all spins. */
static double linear_spinning_error(const char *file, int tapered)
{
  static fb_analyse_work analyse_work;
  static fb_spectrum spectrum;
  static fb_body_desc desc;
  const fbt_table *table = fbt_reference(file);
  fb_modes_desc keep;
  double worst = 0.0, eta = -1.0, radius = -1.0;
  for (int row = 0; row < 2 * table->rows; row++) { /* first all of lag, then of flap */
    const int flap = row >= table->rows, at = row % table->rows, mode = (int)fbt_value(table, at, "mode");
    const double want = fbt_value(table, at, flap ? "mu_flap" : "mu_lag");
    fb_state state;
    fb_input input;
    if (row % table->rows == 0 || fbt_value(table, at, "alpha") != radius) {
      radius = fbt_value(table, at, "alpha");
      eta = -1.0;
      rotor_blade(tapered);
      beam_desc.n_element = 20;
      beam_desc.position[0] = (fb_real)radius;
      memset(&desc, 0, sizeof desc);
      memset(&keep, 0, sizeof keep);
      desc.effects = FB_EFFECTS_FULL;
      desc.base = FB_BASE_PRESCRIBED;
      keep.spin = FB_R(40.0);
      keep.spin_radius = (fb_real)radius;
      keep.count[flap ? FB_KIND_BEND_Z : FB_KIND_BEND_Y] = 20;
      FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
      FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
      FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
      FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
      FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
    }
    if (fbt_value(table, at, "eta") != eta) {
      eta = fbt_value(table, at, "eta");
      memset(&input, 0, sizeof input);
      input.w[2] = (fb_real)eta;
      FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
      FBT_INT_EQ(fb_body_trim(&body, &state, &analyse_work, &input), FB_OK);
      FBT_INT_EQ(fb_body_spectrum(&spectrum, &analyse_work, &body, &state, &input), FB_OK);
    }
    if (want > 0.0) { /* the mode's own number: of one plane there are no others */
      worst = fmax(worst, fabs((double)spectrum.im[mode - 1] / want - 1.0));
      FBT_NEAR_ABS(spectrum.re[mode - 1], 0.0, FBT_TOL(1e-9, 1e-3) * want);
    }
  }
  return worst;
}

/* E12.2, E12.3: eigenvalues of rotating cantilevers about their steady spin (tests/reference/p02), to 1e-6. */
TEST(linear_models_of_spinning_beams_have_the_published_frequencies)
{
  const double uniform = linear_spinning_error("p02_rotating_uniform.csv", 0);
  const double tapered = linear_spinning_error("p02_rotating_tapered.csv", 1);
  fbt_figure("eigenvalues of a rotating cantilever, four of flap and lag, eta 0..50", "power series (p02)", uniform);
  fbt_figure("the same of a tapered one", "power series (p02)", tapered);
  FBT_BELOW(uniform, FBT_TOL(1e-6, 5e-2));
  FBT_BELOW(tapered, FBT_TOL(1e-6, 5e-2));
}

/* Bad input returns its status and changes nothing. */
TEST(bodies_refuse_bad_input)
{
  static fb_body_desc desc;
  static fb_body before;
  int node[2], at = -7;
  fb_state state, same;
  fb_input input;
  fb_real v[3] = {0}, w[3] = {0}, nan3[3] = {0};
  const fb_real center[3] = {0}, bad_inertia[6] = {1, 1, 5, 0, 0, 0}, inertia[6] = {1, 1, 1, 0, 0, 0};
  nan3[1] = (fb_real)NAN;
  boom_body(FB_EFFECTS_FULL, FB_BASE_FREE, node);
  memcpy(&before, &body, sizeof body);
  FBT_INT_EQ(fb_shape_init(NULL, 1), FB_ERR_NULL);
  FBT_INT_EQ(fb_shape_init(&shape, -1), FB_ERR_VALUE);
  FBT_INT_EQ(fb_shape_init(&shape, FB_MAX_MODES + 1), FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, -FB_R(1.0), center, inertia), FB_ERR_VALUE);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(1.0), center, bad_inertia), FB_ERR_VALUE);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(1.0), nan3, inertia), FB_ERR_NOT_FINITE);
  FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(1.0), nan3, modes.shape, NULL), FB_ERR_NOT_FINITE);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 1, &beam, &modes), FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &at, 0, &beam, &modes, FB_R(4.1)), FB_ERR_VALUE);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &at, 0, &beam, &modes, (fb_real)NAN), FB_ERR_NOT_FINITE);
  FBT_INT_EQ(at, -7);
  memset(&desc, 0, sizeof desc);
  desc.effects = FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA;
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_ERR_EFFECTS);
  desc.effects = 1u << 20;
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_ERR_EFFECTS);
  desc.effects = FB_EFFECTS_FULL;
  desc.zeta[0] = -FB_R(0.1);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_ERR_VALUE);
  desc.zeta[0] = (fb_real)INFINITY;
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_ERR_NOT_FINITE);
  desc.zeta[0] = 0;
  FBT_INT_EQ(fb_body_init(&body, &body_work, NULL, &desc), FB_ERR_NULL);
  FBT_TRUE(memcmp(&before, &body, sizeof body) == 0);
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK); /* no mass; then a point mass: no inertia for a free body */
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_ERR_VALUE);
  FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(1.0), center, NULL, NULL), FB_OK);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_ERR_SINGULAR);
  desc.base = FB_BASE_PRESCRIBED;
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  boom_body(FB_EFFECTS_FULL, FB_BASE_FREE, node);
  boom_state(&state, 0.01);
  same = state;
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, nan3, w, NULL), FB_ERR_NOT_FINITE);
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, NULL, NULL), FB_ERR_NULL);
  FBT_TRUE(memcmp(&same, &state, sizeof state) == 0);
  memset(&input, 0, sizeof input);
  input.n_load = FB_MAX_LOADS + 1;
  FBT_INT_EQ(fb_body_rates(&body, &same, &state, &input), FB_ERR_CAPACITY);
  input.n_load = 1;
  input.load[0].node = 3;
  FBT_INT_EQ(fb_body_rates(&body, &same, &state, &input), FB_ERR_CAPACITY);
  input.load[0].node = 1;
  input.load[0].axes = (fb_axes)3;
  FBT_INT_EQ(fb_body_rates(&body, &same, &state, &input), FB_ERR_VALUE);
  input.load[0].axes = FB_AXES_BODY;
  input.load[0].force[0] = (fb_real)NAN;
  FBT_INT_EQ(fb_body_rates(&body, &same, &state, &input), FB_ERR_NOT_FINITE);
  memset(&same, 0, sizeof same);
  FBT_INT_EQ(fb_state_from_velocity(&body, &same, v, w, NULL), FB_ERR_VALUE); /* no attitude */
  FBT_TRUE(fb_rk4_limit(&body, (fb_real)NAN, 0) == FB_R(0.0));
  desc.effects = FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA | FB_EFFECT_SPIN_STIFFENING;
  desc.base = FB_BASE_FREE; /* would depend on the choice of O */
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_ERR_EFFECTS);
  state.q[0] = FB_R(1e3);
  FBT_INT_EQ(fb_state_check(&body, &state), FB_ERR_RANGE);
  state.q[0] = (fb_real)NAN;
  FBT_INT_EQ(fb_state_check(&body, &state), FB_ERR_NOT_FINITE);
}

/* E8.13 with n = 0: a rigid body is a case of the same code; a free asymmetric top against Jacobi elliptic
   functions. */
TEST(a_rigid_body_is_the_case_of_no_modes)
{
  const fbt_table *table = fbt_reference("p10_asymmetric_top.csv");
  static fb_body_desc desc;
  static const fb_real center[3] = {0}, inertia[6] = {1, 2, 3, 0, 0, 0};
  static const fb_real v[3] = {0}, w[3] = {FB_R(0.1), FB_R(5.0), FB_R(0.1)};
  fb_state state;
  fb_rk4_work work;
  fb_motion motion;
  double error = 0.0;
  memset(&desc, 0, sizeof desc);
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(1.0), center, inertia), FB_OK);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, w, NULL), FB_OK);
  for (int k = 1; k <= FBT_TOL(10, 3); k++) { /* one row a second */
    for (int i = 0; i < 4000; i++) {
      FBT_INT_EQ(fb_rk4_step(&body, &state, &work, NULL, NULL, NULL, FB_R(0.00025)), FB_OK);
    }
    FBT_INT_EQ(fb_body_motion(&body, &motion, &state, NULL), FB_OK);
    error = fmax(error, fabs((double)motion.w[0] - fbt_value(table, k, "w1")));
    error = fmax(error, fabs((double)motion.w[1] - fbt_value(table, k, "w2")));
    error = fmax(error, fabs((double)motion.w[2] - fbt_value(table, k, "w3")));
    error = fmax(error, fabs((double)state.quat[1] * fbt_value(table, k, "q0") -
                             (double)state.quat[0] * fbt_value(table, k, "q1")));
  }
  fbt_figure("free asymmetric top", "Jacobi elliptic functions (p10)", error);
  FBT_BELOW(error, FBT_TOL(1e-8, 1e-2)); /* the motion passes its separatrix: errors grow e-fold by e-fold */
}

/* x M^-1 y^T of two sets of n rows of three (x: element of row a at x + step a). */
static void inertial_product(double out[9], const fb_real *x, int x_step, const fb_real *y, int y_step,
                             const fb_shape *in)
{
  static fb_real L[FB_MAX_MODES * FB_MAX_MODES], column[FB_MAX_MODES], solved[FB_MAX_MODES];
  memcpy(L, in->M, sizeof(fb_real) * (size_t)(in->n * in->n));
  FBT_INT_EQ(fb_chol_factor(L, in->n), FB_OK);
  for (int j = 0; j < 3; j++) {
    for (int a = 0; a < in->n; a++) {
      column[a] = y[a * y_step + j];
    }
    fb_chol_solve(solved, L, column, in->n);
    for (int i = 0; i < 3; i++) {
      out[3 * i + j] = 0.0;
      for (int a = 0; a < in->n; a++) {
        out[3 * i + j] += (double)x[a * x_step + i] * (double)solved[a];
      }
    }
  }
}

static void skew(double out[9], const fb_real *v, double sign)
{
  const double x = sign * (double)v[0], y = sign * (double)v[1], z = sign * (double)v[2];
  const double m[9] = {0, -z, y, z, 0, -x, -y, x, 0};
  memcpy(out, m, sizeof m);
}

static double largest_difference(const double *a, const double *b)
{
  double largest = 0.0;
  for (int i = 0; i < 9; i++) {
    largest = fmax(largest, fabs(a[i] - b[i]));
  }
  return largest;
}

/* E8.1: [DB] (41), ups_ab = -ups_ba, ups_ab^ = Pi_ab - Pi_ba, h_a^ = Gam_a - Gam_a^T, hold for the boom to rounding. */
TEST(shape_integrals_obey_the_vector_identities)
{
  int node[2];
  boom(&shape, node);
  for (int a = 0; a < BOOM_MODES; a++) {
    double h[9], gam[9];
    skew(h, shape.H + 3 * a, 1.0);
    for (int i = 0; i < 9; i++) {
      gam[i] = (double)shape.Gam[9 * a + i] - (double)shape.Gam[9 * a + 3 * (i % 3) + i / 3];
    }
    FBT_BELOW(largest_difference(h, gam), FBT_TOL(1e-13, 1e-4));
    for (int b = 0; b < BOOM_MODES; b++) {
      const fb_real *ups = shape.ups + 3 * (a * BOOM_MODES + b), *back = shape.ups + 3 * (b * BOOM_MODES + a);
      double u[9], minus[9], pi_ab[9];
      skew(u, ups, 1.0);
      skew(minus, back, -1.0);
      for (int i = 0; i < 9; i++) {
        pi_ab[i] = (double)shape.Pi[9 * (a * BOOM_MODES + b) + i] - (double)shape.Pi[9 * (b * BOOM_MODES + a) + i];
      }
      FBT_BELOW(largest_difference(u, minus), FBT_TOL(1e-15, 1e-6));
      FBT_BELOW(largest_difference(u, pi_ab), FBT_TOL(1e-14, 1e-5));
    }
  }
}

/* E8.1, E6.7: the inertial identities [DB] (46) with N cubic elements, p07_identities.csv: defects of P M^-1 P^T = m, H
   M^-1 P^T = c^, H M^-1 H^T = J, and, closed basis (C), of the three with Upsilon, which hold for every N. With natural
   modes the sums (43) rise with every mode, from the first bending mode on, and stay below. */
TEST(inertial_identities_hold_as_published)
{
  const fbt_table *table = fbt_reference("p07_identities.csv");
  int rows = 0;
  for (int row = 0; row < table->rows; row++) {
    static fb_modes_desc keep;
    const int closed = fbt_word(table, row, "basis")[0] == 'C', N = (int)fbt_value(table, row, "N");
    double d[9];
    if (N > 4) {
      continue;
    }
    memset(&beam_desc, 0, sizeof beam_desc);
    memset(&keep, 0, sizeof keep);
    beam_desc.length = FB_R(10.0);
    beam_desc.n_element = N;
    beam_desc.n_station = 1;
    beam_desc.station[0].mass = FB_R(1.2);
    beam_desc.station[0].EI_z = beam_desc.station[0].EA = FB_R(1e4);
    keep.basis = FB_BASIS_FUNCTIONS;
    keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_AXIAL] = 2 * N;
    keep.root_strain = !closed;
    FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
    FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
    inertial_product(d, shape.P, 3, shape.P, 3, &shape);
    FBT_NEAR_ABS(1.0 - d[0] / 12.0, fbt_value(table, row, "PMP_x"), FBT_TOL(2e-6, 1e-4));
    FBT_NEAR_ABS(1.0 - d[4] / 12.0, fbt_value(table, row, "PMP_y"), FBT_TOL(2e-6, 1e-4));
    inertial_product(d, shape.H, 3, shape.P, 3, &shape);
    FBT_NEAR_ABS(1.0 - d[7] / 60.0, fbt_value(table, row, "HMP"), FBT_TOL(2e-6, 1e-4));
    inertial_product(d, shape.H, 3, shape.H, 3, &shape);
    FBT_NEAR_ABS(1.0 - d[8] / 400.0, fbt_value(table, row, "HMH"), FBT_TOL(2e-6, 1e-4));
    for (int b = 0; b < shape.n && closed; b++) {
      double expected[9];
      inertial_product(d, shape.ups + 3 * b * shape.n, 3, shape.P, 3, &shape);
      skew(expected, shape.P + 3 * b, -1.0);
      for (int i = 0; i < 9; i++) { /* in the plane: about z */
        FBT_NEAR_ABS(i >= 6 ? d[i] - expected[i] : 0.0, 0.0, FBT_TOL(1e-12, 1e-4));
      }
    }
    rows++;
  }
  FBT_INT_EQ(rows, 8);
  {
    double before[3] = {0.0, 0.0, 0.0};
    for (int n = 1; n <= 4; n++) {
      static fb_modes_desc keep;
      double d[9];
      memset(&keep, 0, sizeof keep);
      for (int kind = 0; kind < FB_KIND_COUNT; kind++) {
        keep.count[kind] = n;
      }
      beam_desc.n_element = 6;
      beam_desc.station[0].EI_y = beam_desc.station[0].GJ = FB_R(1e4);
      beam_desc.station[0].i_y = beam_desc.station[0].i_z = FB_R(0.01);
      FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
      FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
      FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
      FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
      for (int k = 0; k < 3; k++) {
        double now;
        inertial_product(d,
                         k == 2 ? shape.ups
                         : k    ? shape.H
                                : shape.P,
                         3,
                         k == 2 ? shape.ups
                         : k    ? shape.H
                                : shape.P,
                         3, &shape);
        now = k == 0   ? (d[0] + d[4] + d[8]) / 36.0
              : k == 1 ? (d[0] + d[4] + d[8]) / (double)(shape.J[0] + shape.J[4] + shape.J[8])
                       : (d[0] + d[4] + d[8]) / (double)(shape.Pi[0] + shape.Pi[4] + shape.Pi[8]);
        FBT_TRUE(now > before[k] && now < 1.0);
        before[k] = now;
      }
    }
    FBT_BELOW(0.85, before[0]);
    FBT_BELOW(0.95, before[1]);
  }
}

static fb_real half_unit = FB_R(1.0); /* [kg] of halves */
static double half_turn;              /* [rad] of the outer one about the line */

/* The boom in its own axes as one beam, or its inner or outer half as a component. */
static void half_beam(fb_beam *out, fb_modes *basis, int half, int elements, fb_root root, fb_basis kind)
{
  static fb_modes_desc keep;
  const fb_real third = FB_R(1.0) / FB_R(3.0);
  memset(&beam_desc, 0, sizeof beam_desc);
  memset(&keep, 0, sizeof keep);
  beam_desc.length = half < 0 ? FB_R(6.0) : half ? FB_R(4.0) : FB_R(2.0); /* a third and two thirds */
  beam_desc.position[0] = half > 0 ? FB_R(6.0) * third + FB_R(0.5) : FB_R(0.5);
  beam_desc.attitude[0] = half > 0 ? (fb_real)cos(0.5 * half_turn) : FB_R(1.0);
  beam_desc.attitude[1] = half > 0 ? (fb_real)sin(0.5 * half_turn) : FB_R(0.0);
  beam_desc.n_element = elements;
  beam_desc.root = root;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = FB_R(1.3) * half_unit;
  beam_desc.station[0].EI_y = FB_R(50.0) * half_unit;
  beam_desc.station[0].EI_z = FB_R(80.0) * half_unit;
  beam_desc.station[0].i_y = beam_desc.station[0].i_z = FB_R(0.01) * half_unit;
  keep.basis = kind;
  keep.count[FB_KIND_BEND_Y] = kind == FB_BASIS_MODES ? 3 : 1;
  keep.count[FB_KIND_BEND_Z] = kind == FB_BASIS_MODES ? 4 : 1;
  keep.cubic = 1;
  keep.n_boundary = kind == FB_BASIS_COMPONENT ? 4 : 0;
  for (int i = 0; i < 4; i++) {
    static const int axis[4] = {1, 2, 4, 5};
    keep.boundary[i].node = half ? 0 : elements;
    keep.boundary[i].axis = axis[i];
  }
  FBT_INT_EQ(fb_beam_init(out, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(basis, &modes_work, out, &keep), FB_OK);
}

/* E7.11, E7.12, E8.2: a beam cut at a third, with all finite-element coordinates of both parts, welded again: the
   frequencies of the uncut beam, and the body of the parts has its integrals, the quadratic field, which goes on from
   the weld, among them. Modes agree but for their sign, which the tip tells. A second, redundant weld changes
   nothing. */
TEST(joined_halves_are_the_whole)
{
  static fb_beam part[2];
  static fb_modes basis[2], joined[2];
  static fb_join_work join_work;
  static fb_shape whole;
  static const fb_weld weld[2] = {{{0, 1}, {2, 0}}, {{1, 0}, {0, 2}}};
  double largest = 0.0, sign[7];
  int node, tip;
  half_beam(&beam, &modes, -1, 6, FB_ROOT_CLAMPED, FB_BASIS_MODES);
  FBT_INT_EQ(fb_shape_init(&whole, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&whole, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&whole, &tip, 0, &beam, &modes, FB_R(6.0)), FB_OK);
  half_beam(&part[0], &basis[0], 0, 2, FB_ROOT_CLAMPED, FB_BASIS_ELEMENTS);
  half_beam(&part[1], &basis[1], 1, 4, FB_ROOT_FREE, FB_BASIS_ELEMENTS);
  for (int redundant = 0; redundant < 2; redundant++) {
    FBT_INT_EQ(fb_modes_join(joined, &join_work, part, basis, 2, weld, 1 + redundant, 7, FB_R(0.0)), FB_OK);
    for (int k = 0; k < 7; k++) {
      largest = fmax(largest, fabs((double)(joined[0].omega[k] / modes.omega[k]) - 1.0));
      FBT_INT_EQ(joined[1].kind[k], modes.kind[k]);
    }
  }
  FBT_BELOW(largest, FBT_TOL(1e-8, 1e-3));
  fbt_figure("beam cut and joined, nothing truncated", "uncut beam", largest);
  FBT_INT_EQ(fb_shape_init(&shape, 7), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &part[0], &joined[0]), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &part[1], &joined[1]), FB_ERR_VALUE); /* nothing to hang from yet */
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &part[0], &joined[0], FB_R(2.0)), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &part[1], &joined[1]), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &part[1], &joined[1], FB_R(4.0)), FB_OK);
  FBT_NEAR_REL(shape.mass, 7.8, FBT_TOL(1e-14, 1e-6));
  for (int a = 0; a < 7; a++) {
    const int axis = modes.kind[a] == FB_KIND_BEND_Y ? 1 : 2;
    sign[a] = (double)(shape.node[node].psi[3 * a + axis] / whole.node[tip].psi[3 * a + axis]);
    FBT_NEAR_ABS(fabs(sign[a]), 1.0, FBT_TOL(1e-7, 1e-2));
    sign[a] = sign[a] < 0.0 ? -1.0 : 1.0;
  }
  for (int a = 0; a < 7; a++) {
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(shape.P[3 * a + i], sign[a] * (double)whole.P[3 * a + i], FBT_TOL(1e-6, 2e-2));
      FBT_NEAR_ABS(shape.H[3 * a + i], sign[a] * (double)whole.H[3 * a + i], FBT_TOL(1e-6, 5e-2));
    }
    for (int b = 0; b < 7; b++) {
      const int ab = a * 7 + b;
      FBT_NEAR_ABS(shape.M[ab], a == b, FBT_TOL(1e-9, 1e-3));
      FBT_NEAR_ABS(shape.K[ab], a == b ? pow((double)modes.omega[a], 2.0) : 0.0,
                   FBT_TOL(1e-6, 1e-2) * pow((double)modes.omega[6], 2.0));
      for (int i = 0; i < 9; i++) {
        FBT_NEAR_ABS(shape.Gamchi[9 * ab + i], sign[a] * sign[b] * (double)whole.Gamchi[9 * ab + i],
                     FBT_TOL(1e-5, 5e-2) * (1.0 + fabs((double)whole.Gamchi[9 * ab + i])));
      }
    }
    for (int b = 0; b <= a; b++) {
      const int pair = 3 * (a * (a + 1) / 2 + b);
      for (int i = 0; i < 3; i++) {
        FBT_NEAR_ABS(shape.node[node].chi[pair + i], sign[a] * sign[b] * (double)whole.node[tip].chi[pair + i],
                     FBT_TOL(1e-5, 5e-2) * (1.0 + fabs((double)whole.node[tip].chi[pair + i])));
      }
    }
  }
}

/* E7.11, E7.12: what is redundant in the welds, up to rounding, does not depend on the unit of mass. */
TEST(joints_know_no_unit_of_mass)
{
  static fb_beam part[2];
  static fb_modes basis[2], joined[2];
  static fb_join_work join_work;
  static const fb_weld weld[2] = {{{0, 1}, {2, 0}}, {{1, 0}, {0, 2}}};
  double omega[4];
  for (int k = 0; k < 3; k++) {
    half_unit = (fb_real)ldexp(1.0, k == 0 ? 0 : k == 1 ? 40 : -40);
    half_beam(&part[0], &basis[0], 0, 2, FB_ROOT_CLAMPED, FB_BASIS_ELEMENTS);
    half_beam(&part[1], &basis[1], 1, 3, FB_ROOT_FREE, FB_BASIS_ELEMENTS);
    FBT_INT_EQ(fb_modes_join(joined, &join_work, part, basis, 2, weld, 2, 4, FB_R(0.0)), FB_OK);
    for (int a = 0; a < 4; a++) {
      omega[a] = k == 0 ? (double)joined[0].omega[a] : omega[a];
      FBT_NEAR_REL(joined[0].omega[a], omega[a], FBT_TOL(1e-9, 1e-3));
    }
  }
  half_unit = FB_R(1.0);
}

/* E8.32: the quadratic field of a free beam that is heavier to one end, and with bodies on it, leaves the mass of the
   line where it is: int chi dm is nothing beside the mass times what the tip moves. */
TEST(a_free_beam_bends_about_its_mass_center)
{
  for (int lumps = 0; lumps < 2; lumps++) {
    static fb_modes_desc keep;
    double largest = 0.0;
    int tip;
    half_beam(&beam, &modes, -1, 4, FB_ROOT_FREE, FB_BASIS_MODES);
    memset(&keep, 0, sizeof keep);
    keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 2;
    beam_desc.n_station = 2;
    beam_desc.station[1] = beam_desc.station[0];
    beam_desc.station[1].x = beam_desc.length;
    beam_desc.station[1].mass = FB_R(9.0) * beam_desc.station[0].mass;
    beam_desc.n_lump = 2 * lumps;
    beam_desc.lump[0].node = 2;
    beam_desc.lump[1].node = 4;
    beam_desc.lump[0].mass = beam_desc.lump[1].mass = FB_R(5.0);
    FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
    FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &tip, 0, &beam, &modes, beam_desc.length), FB_OK);
    for (int i = 0; i < 3 * modes.n * (modes.n + 1) / 2; i++) {
      largest = fmax(largest, fabs((double)(shape.mass * shape.node[tip].chi[i])));
    }
    FBT_TRUE(largest > 0.01);
    FBT_BELOW(fbt_largest(shape.pchi, 3 * modes.n * modes.n), 1e-3 * largest);
  }
}

/* E7.12: halves turned against each other about their line have modes that bend both ways: one has the kind of the
   coordinate with the largest share, in units of its modal mass, and the sign in which that is positive. */
TEST(joined_modes_are_of_the_kind_of_their_largest_share)
{
  static fb_beam part[2];
  static fb_modes basis[2], joined[2];
  static fb_join_work join_work;
  static const fb_weld weld = {{0, 1}, {2, 0}};
  for (int turn = 1; turn <= 6; turn++) {
    half_turn = 0.25 * turn;
    half_beam(&part[0], &basis[0], 0, 2, FB_ROOT_CLAMPED, FB_BASIS_ELEMENTS);
    half_beam(&part[1], &basis[1], 1, 4, FB_ROOT_FREE, FB_BASIS_ELEMENTS);
    FBT_INT_EQ(fb_modes_join(joined, &join_work, part, basis, 2, &weld, 1, 7, FB_R(0.0)), FB_OK);
    for (int k = 0; k < 7; k++) {
      double best = 0.0, of_kind[FB_KIND_COUNT] = {0.0};
      for (int ca = 0; ca < basis[0].n + basis[1].n; ca++) {
        const int c = ca >= basis[0].n, a = c ? ca - basis[0].n : ca, ndof = basis[c].ndof;
        const double own = (double)basis[c].M[a * (basis[c].n + 1)];
        double share = 0.0, size = 0.0;
        for (int i = 0; i < ndof; i++) { /* a coordinate of an element moves nothing that another one moves */
          share += (double)joined[c].shape[k * ndof + i] * (double)basis[c].shape[a * ndof + i];
          size += pow((double)basis[c].shape[a * ndof + i], 2.0);
        }
        share *= sqrt(own) / size;
        best = fabs(share) > fabs(best) ? share : best;
        of_kind[basis[c].kind[a]] = fmax(of_kind[basis[c].kind[a]], fabs(share));
      }
      FBT_TRUE(best > 0.0);
      FBT_NEAR_REL(of_kind[joined[0].kind[k]], fabs(best), FBT_TOL(1e-6, 1e-2));
      FBT_INT_EQ(joined[1].kind[k], joined[0].kind[k]);
    }
  }
  half_turn = 0.0;
}

/* E7.12: a beam of two halves that are each other's mirror image: every mode has an equal share in both, and the same sign
   whatever rounding makes of them. */
TEST(joined_twins_have_a_sign_that_rounding_does_not_choose)
{
  static fb_beam part[2];
  static fb_modes basis[2], joined[2];
  static fb_join_work join_work;
  static fb_modes_desc keep;
  static const fb_weld tips = {{0, 1}, {2, 2}};
  const int roundings = FB_SINGLE ? 0 : 16; /* in single those of the halves' own modes are too many for a tie */
  double first[5] = {0.0};
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Y] = 5;
  for (int run = -2; run <= 2; run++) {
    for (int half = 0; half < 2; half++) {
      memset(&beam_desc, 0, sizeof beam_desc);
      beam_desc.length = FB_R(2.0);
      beam_desc.n_element = 2;
      beam_desc.position[0] = half ? FB_R(4.0) : FB_R(0.0);
      beam_desc.attitude[half ? 3 : 0] = FB_R(1.0); /* half a turn about z */
      beam_desc.n_station = 1;
      beam_desc.station[0].mass = FB_R(1.3);
      beam_desc.station[0].EI_z = FB_R(80.0) * (FB_R(1.0) + (fb_real)(roundings * half * run) * FB_EPSILON);
      FBT_INT_EQ(fb_beam_init(&part[half], &beam_desc), FB_OK);
      FBT_INT_EQ(fb_modes_solve(&basis[half], &modes_work, &part[half], &keep), FB_OK);
    }
    FBT_INT_EQ(fb_modes_join(joined, &join_work, part, basis, 2, &tips, 1, 5, FB_R(0.0)), FB_OK);
    for (int k = 0; k < 5; k++) {
      const double middle = (double)joined[1].shape[k * joined[1].ndof + 7], sign = middle < 0.0 ? -1.0 : 1.0;
      FBT_NEAR_ABS(fabs((double)joined[0].shape[k * joined[0].ndof + 7]), fabs(middle), FBT_TOL(1e-9, 1e-3));
      first[k] = run == -2 ? sign : first[k];
      FBT_NEAR_ABS(sign, first[k], 0.0);
    }
  }
}

/* A sound body passes its check in any unit of mass and time; its radius of gyration is the root of the mean square of
   the distance from O: (a^2 + a b + b^2)/3 of a line from a to b, and the sections' own. Held, its bound at rest is its
   highest frequency; effects that are off have none. */
TEST(bodies_are_sound_in_any_unit)
{
  for (int k = 0; k < 9; k++) {
    const double soft = ldexp(1.0, 12 * (k / 3 - 1));
    static fb_modes_desc keep;
    fb_body_desc level;
    half_unit = (fb_real)ldexp(1.0, 20 * (k % 3 - 1));
    half_beam(&beam, &modes, -1, 6, FB_ROOT_CLAMPED, FB_BASIS_MODES);
    beam_desc.station[0].EI_y *= (fb_real)soft;
    beam_desc.station[0].EI_z *= (fb_real)soft;
    memset(&keep, 0, sizeof keep);
    keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 1;
    FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
    FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
    FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
    memset(&level, 0, sizeof level);
    level.effects = FB_EFFECTS_FULL;
    level.base = FB_BASE_PRESCRIBED;
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
    FBT_INT_EQ(fb_body_check(&body), FB_OK);
    FBT_NEAR_REL(body.gyration, sqrt((6.5 * 6.5 + 6.5 * 0.5 + 0.5 * 0.5) / 3.0 + 0.02 / 1.3), FBT_TOL(1e-12, 1e-5));
    FBT_NEAR_REL(body.limit_elastic, modes.omega[modes.n - 1] * modes.omega[modes.n - 1], FBT_TOL(1e-9, 1e-4));
    FBT_TRUE(body.recoil == FB_R(1.0) && body.limit_spin > FB_R(0.0) && body.limit_acceleration > FB_R(0.0));
    level.effects = FB_EFFECTS_LINEAR;
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
    FBT_TRUE(body.limit_spin == FB_R(0.0) && body.limit_acceleration == FB_R(0.0) && body.limit_damping == FB_R(0.0));
    FBT_TRUE(body.limit_slope == FB_R(0.0) && body.limit_tension == FB_R(0.0));
  }
  half_unit = FB_R(1.0);
}

/* E7.12: a rod cut in two that keeps one common mode, along x alone: its outer half hangs from a node at the weld, as
   every other does. */
TEST(joined_rods_hang_from_their_weld)
{
  static fb_beam part[2];
  static fb_modes basis[2], joined[2];
  static fb_modes_desc keep;
  static fb_join_work join_work;
  static const fb_weld weld = {{0, 1}, {1, 0}};
  int node;
  for (int c = 0; c < 2; c++) {
    memset(&beam_desc, 0, sizeof beam_desc);
    memset(&keep, 0, sizeof keep);
    beam_desc.length = FB_R(1.0);
    beam_desc.position[0] = (fb_real)c;
    beam_desc.n_element = 1;
    beam_desc.root = c ? FB_ROOT_FREE : FB_ROOT_CLAMPED;
    beam_desc.n_station = 1;
    beam_desc.station[0].mass = FB_R(2.0);
    beam_desc.station[0].EA = FB_R(7.0);
    keep.basis = FB_BASIS_ELEMENTS;
    keep.count[FB_KIND_AXIAL] = 1;
    FBT_INT_EQ(fb_beam_init(&part[c], &beam_desc), FB_OK);
    FBT_INT_EQ(fb_modes_solve(&basis[c], &modes_work, &part[c], &keep), FB_OK);
  }
  FBT_INT_EQ(fb_modes_join(joined, &join_work, part, basis, 2, &weld, 1, 1, FB_R(0.0)), FB_OK);
  FBT_INT_EQ(joined[1].kind[0], FB_KIND_AXIAL);
  FBT_NEAR_REL(joined[0].omega[0], 1.5707963267948966 / 2.0 * sqrt(7.0 / 2.0), 0.03); /* two elements of first degree */
  FBT_INT_EQ(fb_shape_init(&shape, 1), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &part[0], &joined[0]), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &part[1], &joined[1]), FB_ERR_VALUE);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &part[0], &joined[0], FB_R(1.0)), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &part[1], &joined[1]), FB_OK);
}

/* E7.11, E7.12: Craig-Bampton halves: the error falls as modes are kept; a free-flying pair has no rigid modes left and
   the frequencies of the free beam; what cannot be joined is refused. */
TEST(joined_components_converge_and_refuse)
{
  static fb_beam part[2];
  static fb_modes basis[2], joined[2];
  static fb_modes_desc keep;
  static fb_join_work join_work;
  fb_weld weld = {{0, 1}, {2, 0}};
  fb_status status;
  double before = 1.0;
  half_beam(&beam, &modes, -1, 6, FB_ROOT_FREE, FB_BASIS_MODES);
  for (int count = 1; count <= 3; count++) {
    double largest = 0.0;
    for (int c = 0; c < 2; c++) {
      half_beam(&part[c], &basis[c], c, c ? 4 : 2, FB_ROOT_FREE, FB_BASIS_ELEMENTS); /* for the beam */
      memset(&keep, 0, sizeof keep);
      keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = count;
      keep.rigid = keep.cubic = 1;
      keep.n_load = 4; /* residual flexibility at the weld */
      for (int i = 0; i < 4; i++) {
        static const int axis[4] = {1, 2, 4, 5};
        keep.load[i].node = c ? 0 : 2;
        keep.load[i].axis = axis[i];
      }
      FBT_INT_EQ(fb_modes_solve(&basis[c], &modes_work, &part[c], &keep), FB_OK);
    }
    status = fb_modes_join(joined, &join_work, part, basis, 2, &weld, 1, 4, FB_R(0.0));
    FBT_TRUE(status == FB_OK || (FB_SINGLE && status == FB_ERR_CONVERGENCE)); /* or it says that it cannot tell */
    for (int k = 0; k < 4 && status == FB_OK; k++) {
      largest = fmax(largest, fabs((double)(joined[0].omega[k] / modes.omega[k]) - 1.0));
    }
    FBT_BELOW(largest, count == 1 ? 2e-2 : before);
    before = fmax(largest, FBT_TOL(1e-9, 3e-2));
  }
  FBT_TRUE(fb_modes_join(joined, &join_work, part, basis, 2, &weld, 1, 23, FB_R(0.0)) ==
           (FB_SINGLE ? FB_ERR_CONVERGENCE : FB_ERR_KIND));
  if (!FB_SINGLE) { /* all of them, whatever the unit of time; single precision has no room for the fast ones */
    const int all = basis[0].n + basis[1].n - 6 - 6; /* less the weld and rigid motion */
    for (int fast = 0; fast < 2; fast++) {
      for (int c = 0; c < 2; c++) {
        for (int i = 0; i < basis[c].n * basis[c].n; i++) {
          basis[c].K[i] *= FB_R(1e6);
        }
      }
      FBT_INT_EQ(fb_modes_join(joined, &join_work, part, basis, 2, &weld, 1, 0, FB_R(0.0)), FB_OK);
      FBT_INT_EQ(joined[0].n, all);
      FBT_NEAR_REL(joined[0].omega[0], pow(1e3, fast + 1) * (double)modes.omega[0], 1e-6);
    }
  }
  basis[1].n = FB_MAX_MODES + 1;
  FBT_INT_EQ(fb_modes_join(joined, &join_work, part, basis, 2, &weld, 1, 4, FB_R(0.0)), FB_ERR_CAPACITY);
  basis[1].n = -3;
  FBT_INT_EQ(fb_modes_join(joined, &join_work, part, basis, 2, &weld, 1, 4, FB_R(0.0)), FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_modes_solve(&basis[1], &modes_work, &part[1], &keep), FB_OK);
  FBT_INT_EQ(fb_modes_join(joined, &join_work, part, basis, 2, &weld, 1, -1, FB_R(0.0)), FB_ERR_VALUE);
  FBT_INT_EQ(fb_modes_join(joined, &join_work, part, basis, FB_MAX_COMPONENTS + 1, &weld, 1, 0, FB_R(0.0)),
             FB_ERR_CAPACITY);
  FBT_INT_EQ(fb_modes_join(joined, &join_work, part, basis, 2, NULL, 1, 0, FB_R(0.0)), FB_ERR_NULL);
  FBT_INT_EQ(fb_modes_join(joined, &join_work, part, basis, 2, &weld, 1, 0, (fb_real)NAN), FB_ERR_NOT_FINITE);
  weld.node[0] = 1; /* not at the same place */
  FBT_INT_EQ(fb_modes_join(joined, &join_work, part, basis, 2, &weld, 1, 4, FB_R(0.0)), FB_ERR_VALUE);
  weld.node[0] = 3;
  FBT_INT_EQ(fb_modes_join(joined, &join_work, part, basis, 2, &weld, 1, 4, FB_R(0.0)), FB_ERR_CAPACITY);
  weld.node[0] = 2;
  weld.component[1] = 0; /* with itself */
  weld.node[1] = 2;
  FBT_INT_EQ(fb_modes_join(joined, &join_work, part, basis, 2, &weld, 1, 4, FB_R(0.0)), FB_ERR_VALUE);
}

/* E8.1, E6.2: the boom's beam rebuilt as a finite-element model: lumped masses at nodes with displacements, rotations
   and rotary inertia, the quadratic integrals by pairs. With many nodes the integrals are those of the beam (midpoints:
   error 1/nodes^2); the node's loads and motions are those of the beam's node. */
TEST(finite_element_models_are_the_beams_they_came_from)
{
  static fb_shape model;
  const int nodes = 400;
  int node[2], at;
  boom(&shape, node); /* its hub and tip body stay out */
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  beam.desc.n_lump = 0;
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node[0], 0, &beam, &modes, FB_R(3.0)), FB_OK);
  FBT_INT_EQ(fb_shape_init(&model, modes.n), FB_OK);
  for (int k = 0; k < nodes; k++) {
    const fb_real x = FB_R(4.0) * ((fb_real)k + FB_R(0.5)) / (fb_real)nodes, dx = FB_R(4.0) / (fb_real)nodes;
    fb_section s;
    fb_real local[9] = {0}, half[9], J[9], inertia[6];
    const fb_node *n = &shape.node[2];
    shape.n_node = 2;
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &at, 0, &beam, &modes, x), FB_OK);
    fb_beam_section(&s, &beam, x);
    local[0] = dx * (s.i_y + s.i_z);
    local[4] = dx * s.i_y;
    local[8] = dx * s.i_z;
    fb_mat33_mul(half, beam.axes, local);
    for (int i = 0; i < 9; i++) { /* A J A^T */
      J[i] = half[3 * (i / 3)] * beam.axes[3 * (i % 3)] + half[3 * (i / 3) + 1] * beam.axes[3 * (i % 3) + 1] +
             half[3 * (i / 3) + 2] * beam.axes[3 * (i % 3) + 2];
    }
    inertia[0] = J[0];
    inertia[1] = J[4];
    inertia[2] = J[8];
    inertia[3] = J[1];
    inertia[4] = J[2];
    inertia[5] = J[5];
    FBT_INT_EQ(fb_shape_add_lump(&model, dx * s.mass, n->r, inertia, n->psi, n->theta), FB_OK);
  }
  FBT_NEAR_REL(model.mass, shape.mass, FBT_TOL(1e-6, 1e-4));
  for (int a = 0; a < modes.n; a++) {
    for (int i = 0; i < 3; i++) {
      FBT_NEAR_ABS(model.P[3 * a + i], shape.P[3 * a + i], 2e-4);
      FBT_NEAR_ABS(model.H[3 * a + i], shape.H[3 * a + i], 1e-3);
    }
    for (int b = 0; b < modes.n; b++) {
      const int ab = a * modes.n + b;
      FBT_NEAR_ABS(model.M[ab], shape.M[ab], 1e-3);
      for (int i = 0; i < 9; i++) {
        FBT_NEAR_ABS(model.Pi[9 * ab + i], shape.Pi[9 * ab + i], 1e-3);
      }
      if (b <= a) {
        const fb_real *G = shape.Gamchi + 9 * ab;
        fb_real rest[9];
        for (int i = 0; i < 9; i++) {
          rest[i] = G[i] - model.Gamchi[9 * ab + i];
        }
        FBT_INT_EQ(fb_shape_add_pair(&model, a, b, shape.pchi + 3 * ab, NULL, rest), FB_OK);
        for (int i = 0; i < 9; i++) {
          FBT_NEAR_ABS(model.Gamchi[9 * (b * modes.n + a) + i], G[i], FBT_TOL(1e-12, 1e-4));
        }
      }
    }
  }
  FBT_INT_EQ(fb_shape_add_node(&model, &at, shape.node[1].r, shape.node[1].psi, shape.node[1].theta), FB_OK);
  FBT_INT_EQ(at, 1);
  FBT_TRUE(memcmp(model.node[1].psi, shape.node[1].psi, sizeof shape.node[1].psi) == 0);
  { /* bad input leaves the model as it is */
    static fb_shape kept;
    const fb_real bad[3] = {0, (fb_real)NAN, 0}, odd[6] = {FB_R(1.0), FB_R(1.0), FB_R(3.0), 0, 0, 0};
    memcpy(&kept, &model, sizeof model);
    FBT_INT_EQ(fb_shape_add_lump(&model, -FB_R(1.0), shape.node[1].r, NULL, shape.node[1].psi, shape.node[1].theta),
               FB_ERR_VALUE);
    FBT_INT_EQ(fb_shape_add_lump(&model, FB_R(1.0), shape.node[1].r, odd, shape.node[1].psi, shape.node[1].theta),
               FB_ERR_VALUE);
    FBT_INT_EQ(fb_shape_add_lump(&model, FB_R(1.0), bad, NULL, shape.node[1].psi, shape.node[1].theta),
               FB_ERR_NOT_FINITE);
    FBT_INT_EQ(fb_shape_add_lump(&model, FB_R(1.0), shape.node[1].r, NULL, NULL, shape.node[1].theta), FB_ERR_NULL);
    FBT_INT_EQ(fb_shape_add_node(&model, NULL, shape.node[1].r, shape.node[1].psi, shape.node[1].theta), FB_ERR_NULL);
    FBT_INT_EQ(fb_shape_add_pair(&model, 0, modes.n, NULL, NULL, NULL), FB_ERR_CAPACITY);
    FBT_INT_EQ(fb_shape_add_pair(&model, 0, 1, bad, NULL, NULL), FB_ERR_NOT_FINITE);
    FBT_TRUE(memcmp(&kept, &model, sizeof model) == 0);
  }
}

/* E6.3, E6.6, E8.1: Hopkins' beam element (C.1, C.2 with ERRATA.md; p09_beam_element.csv): stiffness, geometric
   stiffness, consistent mass with rotary inertia, and the first- and second-order integrals of its six coordinates (q1,
   q2 axial, q3, q4 transverse, q5, q6 rotation): mass center P, inertia I1 = int (r.P) 1 - r P and I2 = int (P_i.P_j) 1
   - P_i P_j, moments O1 = int r x P and O2 = int P_i x P_j. */
TEST(hopkins_element_has_the_exact_integrals)
{
  static const int place[7] = {0, 0, 3, 1, 4, 2, 5}; /* of q1 .. q6 among u_x, u_y, theta_z of both ends */
  const fbt_table *table = fbt_reference("p09_beam_element.csv");
  static fb_modes_desc keep;
  static fb_modes pulled;
  const double l = 2.0, h = 0.2, EA = 3.0, EI = 7.0;
  double largest = 0.0;
  int rows = 0;
  memset(&beam_desc, 0, sizeof beam_desc);
  memset(&keep, 0, sizeof keep);
  beam_desc.length = (fb_real)l;
  beam_desc.n_element = 1;
  beam_desc.root = FB_ROOT_FREE;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = (fb_real)(1.0 / l);
  beam_desc.station[0].i_z = (fb_real)(h * h / 12.0 / l);
  beam_desc.station[0].EA = (fb_real)EA;
  beam_desc.station[0].EI_z = (fb_real)EI;
  keep.basis = FB_BASIS_ELEMENTS;
  keep.count[FB_KIND_AXIAL] = keep.count[FB_KIND_BEND_Y] = 1;
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  keep.preload.force = FB_R(1.0);
  FBT_INT_EQ(fb_modes_solve(&pulled, &modes_work, &beam, &keep), FB_OK);
  keep.preload.force = FB_R(0.0);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(modes.n, 6);
  FBT_INT_EQ(fb_shape_init(&shape, 6), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  for (int row = 0; row < table->rows; row++) {
    const char *kind = fbt_word(table, row, "kind"), *comp = fbt_word(table, row, "comp");
    const int index = (int)fbt_value(table, row, "index");
    const int i1 = index > 10 ? index / 10 : index, i2 = index > 10 ? index % 10 : 0;
    const int a = place[i1 % 7], b2 = place[i2 % 7];
    const int ab = a * 6 + b2, ba = b2 * 6 + a, i = comp[0] - 'x', j = comp[1] ? comp[1] - 'x' : i;
    const double value = fbt_value(table, row, "value_l2_h02");
    double got;
    if (strcmp(kind, "K") == 0) {
      got = (double)modes.K[ab] / (comp[1] == 'A' ? EA : EI);
    } else if (strcmp(kind, "KG") == 0) {
      got = (double)(pulled.K[ab] - modes.K[ab]);
    } else if (strcmp(kind, "M") == 0) {
      got = (double)modes.M[ab];
    } else if (strcmp(kind, "P") == 0) {
      got = (double)shape.P[3 * a + i];
    } else if (strcmp(kind, "I1") == 0) {
      got = (double)shape.Gam[9 * a + 3 * i + j];
    } else if (strcmp(kind, "O1") == 0) {
      got = (double)shape.H[3 * a + i];
    } else if (strcmp(kind, "I2") == 0) {
      got = (double)shape.Pi[9 * ba + 3 * i + j];
    } else {
      got = -(double)shape.ups[3 * ab + i];
    }
    FBT_NEAR_ABS(got, value, FBT_TOL(2e-12, 2e-6) * (1.0 + fabs(value))); /* the file has 12 digits */
    largest = fmax(largest, fabs(got - value));
    rows++;
  }
  FBT_INT_EQ(rows, table->rows);
  FBT_TRUE(rows > 200);
  fbt_figure("beam element: K, KG, M, inertia and moments", "[H] C.1, C.2 (p09)", largest);
}

/* E8.31: a cantilever with a force F at the tip: strain F (L - x) y/EI in element coordinates, exactly. */
TEST(a_strain_gauge_reads_the_bending_moment)
{
  static fb_modes_desc keep;
  static fb_real K[FB_MAX_MODES * FB_MAX_MODES];
  static const double x[] = {0.0, 0.7, 1.3, 2.0};
  fb_real q[FB_MAX_MODES], f[FB_MAX_MODES];
  fb_gauge gauge;
  int node;
  memset(&beam_desc, 0, sizeof beam_desc);
  beam_desc.length = FB_R(2.0);
  beam_desc.n_element = 3;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = FB_R(1.0);
  beam_desc.station[0].EI_y = FB_R(5.0);
  beam_desc.station[0].EI_z = FB_R(4.0);
  memset(&keep, 0, sizeof keep);
  keep.basis = FB_BASIS_ELEMENTS;
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 1;
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, FB_R(2.0)), FB_OK);
  FBT_NEAR_REL(shape.size, 2.0, FBT_TOL(1e-14, 1e-6)); /* out to the tip */
  for (int a = 0; a < modes.n; a++) {
    const fb_real *const tip = shape.node[node].psi + 3 * a;
    FBT_TRUE((double)shape.reach[a] >= (1.0 - FBT_TOL(1e-14, 1e-6)) * sqrt((double)fb_vec3_dot(tip, tip)));
    f[a] = FB_R(0.3) * shape.node[node].psi[3 * a + 1] + FB_R(0.2) * shape.node[node].psi[3 * a + 2];
  }
  memcpy(K, modes.K, sizeof K);
  FBT_INT_EQ(fb_chol_factor(K, modes.n), FB_OK);
  fb_chol_solve(q, K, f, modes.n);
  for (int k = 0; k < 4; k++) {
    const double strain = -(0.05 * 0.3 / 4.0 + 0.03 * 0.2 / 5.0) * (2.0 - x[k]);
    FBT_INT_EQ(fb_gauge_init(&gauge, 0, &beam, &modes, (fb_real)x[k], FB_R(0.05), FB_R(0.03)), FB_OK);
    FBT_NEAR_ABS(fb_gauge_eval(&gauge, q), strain, FBT_TOL(1e-14, 1e-6));
  }
  FBT_INT_EQ(fb_gauge_init(&gauge, 0, &beam, &modes, FB_R(2.1), 0, 0), FB_ERR_VALUE);
}

/* A prescribed body may have no mass, nor inertia: it is as good as others, to the check and to the word. */
TEST(massless_prescribed_bodies_are_sound)
{
  static const fb_real r[3] = {1, 2, 3};
  fb_body_desc desc;
  unsigned word;
  int node;
  memset(&desc, 0, sizeof desc);
  desc.base = FB_BASE_PRESCRIBED;
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
  FBT_INT_EQ(fb_shape_add_node(&shape, &node, r, NULL, NULL), FB_OK);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  FBT_INT_EQ(fb_body_check(&body), FB_OK);
  FBT_TRUE(body.gyration == FB_R(0.0) && body.recoil == FB_R(1.0));
  word = fb_body_crc(&body);
  FBT_TRUE(word != 0);
  body.node[node].r[2] += FB_R(1.0);
  FBT_TRUE(fb_body_crc(&body) != word);
  body.base = FB_BASE_FREE; /* that one needs inertia about every axis */
  FBT_INT_EQ(fb_body_check(&body), FB_ERR_VALUE);
}

/* E8.40: what the word does not see may all be changed at once, nothing that a step reads is among it. */
TEST(the_check_word_sees_every_flipped_bit)
{
  static fb_body flipped, unseen;
  static const fb_real r[3] = {1, 2, 3}, inertia[6] = {3, 4, 5}, psi[6] = {0, 1, 0, 0, 0, 1};
  unsigned char *const bits = (unsigned char *)&flipped, *const rest = (unsigned char *)&unseen;
  const size_t every = FBT_LONG(37, 61); /* bit; of every byte: the_check_word_sees_every_form */
  fb_body_work *const scratch = &body_work;
  fb_body_desc desc;
  fb_state state, rate, again;
  unsigned word;
  int seen = 0;
  memset(&desc, 0, sizeof desc);
  desc.effects = FB_EFFECTS_SPIN;
  FBT_INT_EQ(fb_shape_init(&shape, 2), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(9.0), r, inertia), FB_OK);
  FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(1.0), r, psi, NULL), FB_OK);
  shape.K[0] = shape.K[3] = FB_R(4.0);
  FBT_INT_EQ(fb_body_init(&body, scratch, &shape, &desc), FB_OK);
  word = fb_body_crc(&body);
  unseen = flipped = body;
  for (size_t k = 0; k < 8 * sizeof body; k += every) {
    const unsigned char whole = bits[k / 8];
    bits[k / 8] = (unsigned char)(whole ^ (1u << k % 8));
    if (fb_body_crc(&flipped) == word) {
      rest[k / 8] = (unsigned char)(rest[k / 8] ^ (1u << k % 8));
    } else {
      seen++;
    }
    bits[k / 8] = whole;
  }
  FBT_TRUE(word != 0 && seen > 8 * 100 * (int)sizeof(fb_real) / (int)every);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  state.L[2] = state.u[0] = FB_R(3.0);
  state.q[0] = state.pi[1] = FB_R(0.1);
  FBT_INT_EQ(fb_body_rates(&body, &rate, &state, NULL), FB_OK);
  FBT_INT_EQ(fb_body_rates(&unseen, &again, &state, NULL), FB_OK);
  FBT_INT_EQ(memcmp(&rate, &again, sizeof rate), 0);
}

/* Of n numbers of the body those that may change by one bit, another one in each, without a change of its check word. */
static int numbers_unseen(fb_real *x, int n)
{
  const unsigned word = fb_body_crc(&body);
  unsigned char *const byte = (unsigned char *)x;
  int unseen = 0;
  for (int k = 0; k < n; k++) {
    unsigned char *const at = byte + (size_t)k * sizeof *x + (size_t)k % sizeof *x;
    *at = (unsigned char)(*at ^ (1u << k % 7));
    unseen += fb_body_crc(&body) == word;
    *at = (unsigned char)(*at ^ (1u << k % 7));
  }
  return word == 0 ? n : unseen;
}

/* E8.40: every number of a body with a quadratic field, damping and gravity: those of its nodes, of S and of the matrices. */
TEST(the_check_word_sees_every_number)
{
  const int n = BOOM_MODES;
  int node[2];
  boom_body(FB_EFFECTS_FULL | FB_EFFECT_DAMPING | FB_EFFECT_GRAVITY, FB_BASE_FREE, node);
  for (int k = 0; k < body.n_node; k++) {
    fb_node *const at = &body.node[k];
    FBT_INT_EQ(numbers_unseen(at->r, 3) + numbers_unseen(at->psi, 3 * n) + numbers_unseen(at->theta, 3 * n), 0);
    FBT_INT_EQ(numbers_unseen(at->chi, 3 * n * (n + 1) / 2), 0);
    FBT_INT_EQ(numbers_unseen(at->chi_theta, 3 * n * (n + 1) / 2), 0);
  }
  FBT_INT_EQ(numbers_unseen(body.S + (body.n_S - 40), 40) + numbers_unseen(body.S, 40), 0);
  FBT_INT_EQ(numbers_unseen(body.S0, 21) + numbers_unseen(body.S0_inverse, 36), 0);
  FBT_INT_EQ(numbers_unseen(body.M.diagonal, n) + numbers_unseen(body.Minv.diagonal, n), 0);
  FBT_INT_EQ(numbers_unseen(body.K.diagonal, n) + numbers_unseen(body.C.diagonal, n), 0);
  FBT_INT_EQ(numbers_unseen(body.gravity, 3) + numbers_unseen(body.c, 3) + numbers_unseen(body.reach, n), 0);
  FBT_INT_EQ(numbers_unseen(&body.mass, 1) + numbers_unseen(&body.gyration, 1), 0);
  FBT_INT_EQ(numbers_unseen(&body.deflection_limit, 1) + numbers_unseen(&body.recoil, 1), 0);
  FBT_INT_EQ(numbers_unseen(&body.limit_elastic, 1) + numbers_unseen(&body.limit_damping, 1), 0);
  FBT_INT_EQ(numbers_unseen(&body.limit_spin, 1) + numbers_unseen(&body.limit_acceleration, 1), 0);
  for (int k = 0; k < body.n_lambda; k++) {
    FBT_INT_EQ(numbers_unseen(&body.lambda[k].c, 1), 0);
  }
}

/* E8.40: of changes of 33 bits in a row the word sees all but the one by its polynomial, x^32 first (IEEE 802.3, 3.2.9),
   wherever in eight bytes it begins. */
TEST(the_check_word_is_that_of_its_polynomial)
{
  const unsigned long long polynomial = 0x1DB710641ull; /* the lowest bit comes first */
  int node[2];
  unsigned word;
  boom_body(FB_EFFECTS_FULL, FB_BASE_FREE, node);
  word = fb_body_crc(&body);
  for (int at = 0; at < 32; at++) {
    for (int flip = -1; flip < 33; flip++) {
      const unsigned long long other_bit = flip < 0 ? 0 : 1ull << flip, change = (polynomial ^ other_bit) << at;
      unsigned long long bits;
      memcpy(&bits, body.c, sizeof bits);
      bits ^= change;
      memcpy(body.c, &bits, sizeof bits);
      FBT_INT_EQ(fb_body_crc(&body) == word, flip < 0);
      bits ^= change;
      memcpy(body.c, &bits, sizeof bits);
    }
  }
}

/* Is a change of that index seen? */
static int index_seen(unsigned short *index)
{
  const unsigned word = fb_body_crc(&body);
  int seen;
  *index ^= 1;
  seen = word != 0 && fb_body_crc(&body) != word;
  *index ^= 1;
  return seen;
}

static int pairs_seen(fb_sparse *m)
{
  int seen = m->n_term == 3;
  for (int k = 0; k < m->n_term; k++) {
    seen = seen && numbers_unseen(&m->term[k].c, 1) == 0 && index_seen(&m->term[k].a) && index_seen(&m->term[k].b);
  }
  return seen;
}

/* E8.40: every term of a body whose modes are coupled in mass, stiffness and damping, the first and the last, too. */
TEST(the_check_word_sees_every_term)
{
  const int n = 3;
  fb_body_desc desc;
  particles_random(&cloud, n, 1);
  particles_to_shape(&shape, &cloud);
  memset(&desc, 0, sizeof desc);
  desc.effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING;
  for (int ab = 0; ab < n * n; ab++) {
    shape.K[ab] = ab % (n + 1) == 0 ? FB_R(3.0) : FB_R(0.5);
    desc.zeta[ab / n] = (fb_real)(0.1 + 0.1 * (ab / n));
  }
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  FBT_TRUE(pairs_seen(&body.M) && pairs_seen(&body.Minv) && pairs_seen(&body.K) && pairs_seen(&body.C));
  for (int k = 0; k < body.n_lambda; k++) {
    fb_lambda_term *const t = &body.lambda[k];
    FBT_TRUE(index_seen(&t->i) && index_seen(&t->a) && index_seen(&t->b));
  }
  for (int k = 0; k < body.n_row; k++) {
    FBT_TRUE(index_seen(&body.lambda_row[k].i) && index_seen(&body.lambda_row[k].end));
  }
  for (int k = 0; k < body.n_run; k++) {
    FBT_TRUE(index_seen(&body.run[k].i) && index_seen(&body.run[k].pair) && index_seen(&body.run[k].n));
  }
  for (int k = 0; k < body.n_pair; k++) {
    FBT_TRUE(index_seen(&body.pair[k].a) && index_seen(&body.pair[k].b));
  }
  FBT_INT_EQ(numbers_unseen(body.S, body.n_S), 0);
}

/* A row of Lambda without a term, which no flip of a single bit makes: its index is a place that a step writes to. */
TEST(rows_without_terms_are_refused)
{
  static fb_body spoiled;
  static const fb_real r[3] = {1, 2, 3}, inertia[6] = {3, 4, 5}, psi[6] = {0, 1, 0, 0, 0, 1};
  fb_body_desc desc;
  memset(&desc, 0, sizeof desc);
  desc.effects = FB_EFFECTS_SPIN;
  FBT_INT_EQ(fb_shape_init(&shape, 2), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(9.0), r, inertia), FB_OK);
  FBT_INT_EQ(fb_shape_add_particle(&shape, FB_R(1.0), r, psi, NULL), FB_OK);
  shape.K[0] = shape.K[3] = FB_R(4.0);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  FBT_INT_EQ(fb_body_check(&body), FB_OK);
  FBT_TRUE(body.n_row > 0 && body.n_row < 6);
  spoiled = body;
  for (int k = spoiled.n_row++; k > 0; k--) {
    spoiled.lambda_row[k] = spoiled.lambda_row[k - 1];
  }
  spoiled.lambda_row[0].i = 60000;
  spoiled.lambda_row[0].end = 0;
  FBT_INT_EQ(fb_body_check(&spoiled), FB_ERR_VALUE);
}

/* E3.2, E8.22: a rod of particles, or an inertia with nothing about its axis, turned anyhow, has no inertia about that axis:
   free or pinned it is refused, in units of mass and length of any size. With 1e-8 of the inertia across (single 1e-4) it
   is a body. */
TEST(rods_without_thickness_are_refused_in_every_attitude)
{
  static const double units[5] = {1.0, 1e-6, 1e6, 1e-12, 1e12};
  fbt_seed(41);
  for (int run = 0; run < 4000; run++) {
    const double unit = units[run % FBT_TOL(5, 3)], m = unit * (1.0 + 0.5 * fbt_random());
    const double length = (1.0 + 0.5 * fbt_random()) / sqrt(unit), across = m * length * length / 12.0;
    const double off = run / 5 % 2 ? 0.5 * length : 0.0, slender = run / 10 % 2 ? FBT_TOL(1e-8, 1e-4) : 0.0;
    const int grains = slender == 0.0 && run / 20 % 2;
    const fb_real none[3] = {0};
    fb_real turn[3], quat[4], R[9], J[6], center[3];
    fb_body_desc desc;
    fb_shape rod;
    memset(&desc, 0, sizeof desc);
    desc.base = run % 3 ? FB_BASE_FREE : FB_BASE_PINNED;
    fbt_fill(turn, 3, 3.0);
    fb_quat_from_rotvec(quat, turn);
    fb_quat_to_mat33(R, quat);
    FBT_INT_EQ(fb_shape_init(&rod, 0), FB_OK);
    for (int k = 0; k < 6; k++) { /* across (1 - e e^T) + along e e^T */
      static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
      const double ee = (double)R[3 * row[k]] * (double)R[3 * column[k]];
      J[k] = (fb_real)(across * ((row[k] == column[k] ? 1.0 : 0.0) - (1.0 - slender) * ee));
    }
    for (int i = 0; i < 3; i++) {
      center[i] = (fb_real)(off * (double)R[3 * i]);
    }
    for (int k = 0; k < 5 && grains; k++) {
      fb_real r[3];
      for (int i = 0; i < 3; i++) {
        r[i] = (fb_real)((off + length * (k - 2) / 4.0) * (double)R[3 * i]);
      }
      FBT_INT_EQ(fb_shape_add_particle(&rod, (fb_real)(m / 5.0), r, none, NULL), FB_OK);
    }
    if (!grains) {
      FBT_INT_EQ(fb_shape_add_rigid(&rod, (fb_real)m, center, J), FB_OK);
    }
    FBT_INT_EQ(fb_body_init(&body, &body_work, &rod, &desc), slender > 0.0 ? FB_OK : FB_ERR_SINGULAR);
  }
}

/* What a load is not: a number, on a base that is held and takes it without moving. */
TEST(loads_that_are_no_numbers_are_refused_on_held_bases)
{
  static const fb_base base[] = {FB_BASE_FREE, FB_BASE_PRESCRIBED, FB_BASE_PINNED, FB_BASE_HINGED};
  const fb_real center[3] = {0}, inertia[6] = {1, 1, 1, 0, 0, 0};
  for (int run = 0; run < 8; run++) {
    static fb_body_desc held;
    static fb_rk4_work rk4;
    fb_input input;
    fb_state state;
    fb_motion motion;
    memset(&held, 0, sizeof held);
    memset(&input, 0, sizeof input);
    held.base = base[run / 2];
    input.n_load = 1;
    (run % 2 ? input.load[0].torque : input.load[0].force)[1] = (fb_real)NAN;
    FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
    FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(1.0), center, inertia), FB_OK);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &held), FB_OK);
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    FBT_INT_EQ(fb_body_motion(&body, &motion, &state, &input), FB_ERR_NOT_FINITE);
    FBT_INT_EQ(fb_rk4_step(&body, &state, &rk4, &input, &input, &input, FB_R(1e-3)), FB_ERR_NOT_FINITE);
  }
}

SUITE(body, RUN(loads_that_are_no_numbers_are_refused_on_held_bases),
      RUN(rods_without_thickness_are_refused_in_every_attitude), RUN(rows_without_terms_are_refused),
      RUN(massless_prescribed_bodies_are_sound), RUN(the_check_word_sees_every_flipped_bit),
      RUN(the_check_word_sees_every_number), RUN(the_check_word_sees_every_term), RUN(coordinates_have_any_unit),
      RUN(size_and_reach_are_those_of_the_particles), RUN(potential_energies_agree_with_a_particle_model),
      RUN(integrals_of_a_pair_stand_in_both_places), RUN(damping_is_that_of_a_particle_on_a_spring),
      RUN(the_check_word_is_that_of_its_polynomial), RUN(lumps_have_the_inertia_of_their_node),
      RUN(nodes_are_those_of_the_shape), RUN(nodes_that_turn_far_have_the_rates_of_their_pose),
      RUN(a_strain_gauge_reads_the_bending_moment), RUN(hopkins_element_has_the_exact_integrals),
      RUN(finite_element_models_are_the_beams_they_came_from), RUN(joined_halves_are_the_whole),
      RUN(joints_know_no_unit_of_mass), RUN(a_free_beam_bends_about_its_mass_center),
      RUN(joined_modes_are_of_the_kind_of_their_largest_share),
      RUN(joined_twins_have_a_sign_that_rounding_does_not_choose), RUN(bodies_are_sound_in_any_unit),
      RUN(joined_rods_hang_from_their_weld), RUN(joined_components_converge_and_refuse),
      RUN(shape_integrals_obey_the_vector_identities), RUN(inertial_identities_hold_as_published),
      RUN(accelerations_agree_with_a_particle_model), RUN(momenta_agree_with_a_particle_model),
      RUN(elastic_forces_agree_with_a_particle_model), RUN(each_set_of_effects_follows_its_own_lagrangian),
      RUN(bodies_do_not_depend_on_the_units), RUN(residual_inertia_vanishes_on_a_rotation_closed_basis),
      RUN(functions_close_the_basis), RUN(beam_integrals_reproduce_mass_and_modal_mass),
      RUN(beam_integrals_hold_for_any_section_and_line), RUN(quadratic_field_is_inextensible_and_twist_free),
      RUN(quadratic_field_follows_a_bent_line_in_any_attitude), RUN(offset_masses_move_with_their_section),
      RUN(lumped_bodies_are_the_particles_they_stand_for), RUN(a_beam_may_take_later_coordinates),
      RUN(power_of_loads_is_the_rate_of_energy), RUN_FORMS(combined_coordinates_are_the_same_body),
      RUN_FORMS(power_of_all_loads_is_the_rate_of_energy), RUN(combined_coordinates_of_a_beam_are_the_same_body),
      RUN(recoil_is_what_springs_leave_the_frame), RUN(lines_of_particles_are_refused),
      RUN(a_selection_is_the_body_with_the_others_held), RUN(what_a_symmetry_makes_zero_is_no_term),
      RUN(node_kinematics_match_finite_differences), RUN(reactions_balance_the_momentum),
      RUN(a_held_body_is_a_free_one_with_its_reactions), RUN(pinned_and_hinged_bodies_swing_as_rigid_pendulums),
      RUN(a_falling_body_does_not_deform), RUN(elastic_response_is_frame_indifferent),
      RUN(damped_free_decay_has_the_given_ratio), RUN(spinning_beams_stiffen_as_published),
      RUN(linear_models_of_spinning_beams_have_the_published_frequencies), RUN(a_rigid_body_is_the_case_of_no_modes),
      RUN(bodies_refuse_bad_input))
