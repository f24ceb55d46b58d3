/* Section 8: shape integrals, momentum form, effects, loads, nodes, energy. The judge is a brute-force model of particles
   that knows nothing of momenta or shape integrals: positions r + psi q + 1/2 chi q q, Newton's law per particle. */
#include "fbt.h"

#define PARTICLES 30
#define MAX_N 8

typedef struct particles {
  int n;
  double m[PARTICLES], r[PARTICLES][3], psi[PARTICLES][MAX_N][3], chi[PARTICLES][MAX_N][MAX_N][3];
} particles;

/* Random masses, places and modes; quadratic: random symmetric chi. */
static void particles_random(particles *p, int n, int quadratic)
{
  memset(p, 0, sizeof *p);
  p->n = n;
  for (int i = 0; i < PARTICLES; i++) {
    p->m[i] = (fb_real)(1.0 + 0.5 * fbt_random());
    for (int k = 0; k < 3; k++) {
      p->r[i][k] = (fb_real)fbt_random();
      for (int a = 0; a < n; a++) {
        p->psi[i][a][k] = (fb_real)(0.4 * fbt_random());
        for (int b = 0; quadratic && b <= a; b++) {
          p->chi[i][a][b][k] = p->chi[i][b][a][k] = (fb_real)(0.1 * fbt_random());
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
    s->v[k] = (fb_real)fbt_random();
    s->w[k] = (fb_real)fbt_random();
  }
  for (int a = 0; a < n; a++) {
    s->q[a] = (fb_real)(deflection * fbt_random());
    s->qd[a] = (fb_real)fbt_random();
  }
}

static void cross(double c[3], const double a[3], const double b[3])
{
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

/* Displacement, its variation J (n x 3) and velocity of particle i; degree 1 leaves chi out. */
static void particle_at(double x[3], double J[MAX_N][3], double xd[3], const particles *p, int i, const velocity *s)
{
  for (int k = 0; k < 3; k++) {
    double turn[3], ud[3] = {0};
    x[k] = p->r[i][k];
    for (int a = 0; a < p->n; a++) {
      J[a][k] = p->psi[i][a][k];
      for (int b = 0; b < p->n; b++) {
        J[a][k] += p->chi[i][a][b][k] * s->q[b];
      }
      x[k] += 0.5 * s->q[a] * (p->psi[i][a][k] + J[a][k]);
    }
    (void)turn;
    (void)ud;
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

/* The part of the kinetic energy that is kept: elastic degree (q and qd together) at most 2, exact by interpolation of the
   quartic in a scale factor. */
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
      const double e[3] = {k == 0, k == 1, k == 2};
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
static fb_shape shape;
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
        const double got = (double)(a < 3 ? motion.v_dot[a] : a < 6 ? motion.w_dot[a - 3] : motion.q_ddot[a - 6]);
        scale = fmax(scale, fabs(acc[a]));
        error = fmax(error, fabs(got - acc[a]));
      }
      FBT_BELOW(error / scale, FBT_TOL(1e-9, 2e-3));
      for (int a = 0; a < n; a++) {
        FBT_NEAR_ABS(motion.q_dot[a], s.qd[a], FBT_TOL(1e-11, 1e-3));
      }
    }
  }
}

/* E8.9, E8.11, E8.13, E8.21: momenta are the derivatives of the particles' kinetic energy, degree 2 with chi. */
TEST(momenta_agree_with_a_particle_model)
{
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
      const double got = (double)(a < 3 ? state.P[a] : a < 6 ? state.L[a - 3] : state.pi[a - 6]);
      *x += 1.0;
      *y -= 1.0;
      error = fmax(error, fabs(0.5 * (particles_energy_2(&cloud, &up) - particles_energy_2(&cloud, &down)) - got));
    }
    FBT_BELOW(error, FBT_TOL(1e-11, 1e-4));
    FBT_INT_EQ(fb_body_energy(&body, &energy, &state, NULL), FB_OK);
    FBT_NEAR_REL(energy.kinetic, particles_energy_2(&cloud, &s), FBT_TOL(1e-12, 1e-5));
    FBT_INT_EQ(fb_body_motion(&body, &motion, &state, NULL), FB_OK);
    for (int a = 0; a < n; a++) {
      FBT_NEAR_ABS(motion.q_dot[a], s.qd[a], FBT_TOL(1e-10, 1e-2));
    }
  }
}

/* E8.12 with chi: pi_dot = dT/dq at fixed velocities (Lagrange), by finite differences of the particles' energy. */
TEST(elastic_forces_agree_with_a_particle_model)
{
  for (int n = 1; n <= MAX_N; n++) {
    velocity s;
    fb_state state, rate;
    fb_body_desc desc;
    particles_random(&cloud, n, 1);
    particles_to_shape(&shape, &cloud);
    memset(&desc, 0, sizeof desc);
    desc.effects = FB_EFFECTS_FULL;
    desc.deflection_limit = FB_R(100.0);
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
    velocity_random(&s, n, 0.2);
    state_from(&state, &body, &s);
    FBT_INT_EQ(fb_body_rates(&body, &rate, &state, NULL), FB_OK);
    for (int a = 0; a < n; a++) {
      velocity up = s, down = s;
      up.q[a] += 1.0; /* quadratic in q at fixed velocities: exact */
      down.q[a] -= 1.0;
      FBT_NEAR_ABS(rate.pi[a], 0.5 * (particles_energy_2(&cloud, &up) - particles_energy_2(&cloud, &down)),
                   FBT_TOL(1e-10, 3e-3));
    }
  }
}

SUITE(body, RUN(accelerations_agree_with_a_particle_model), RUN(momenta_agree_with_a_particle_model),
      RUN(elastic_forces_agree_with_a_particle_model))
