/* >>body and >>assemble: bodies against brute-force models of particles, without shape integrals. */
#include "body.h"

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
      FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, &input), FB_OK);
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

/* Total momenta of a state in body axes: (p, h) about O, then pi = those relative to the mass center + (dc/dq)^T R^T
   u. */
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
        slope += (double)(shape.second.pchi[3 * (b * shape.n + d) + i] * state->q[d]);
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
    FBT_INT_EQ(fb_body_energy_eval(&body, &energy, &state, NULL), FB_OK);
    FBT_NEAR_REL(energy.kinetic, particles_energy_2(&cloud, &s), FBT_TOL(1e-12, 1e-5));
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, NULL), FB_OK);
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
    FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, NULL), FB_OK);
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

/* E8.17, E8.19: the same body in units of mass and length that are so many times smaller moves the same: no threshold
   has a unit. For every set of effects, with a stiffness. */
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
      FBT_INT_EQ(fb_body_motion_eval(&body, &motion[unit], &state, NULL), FB_OK);
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

/* E8.4 to E8.6, E8.17, E8.19: each coordinate may have a unit of its own, so that the modal masses are all 2 kg, or as
   far apart as numbers go: the body moves as before, for every set of effects, with stiffness and damping. */
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
      FBT_INT_EQ(fb_body_motion_eval(&body, &motion[run], &state, NULL), FB_OK);
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
        c[i] += 0.5 * (double)shape.second.pchi[3 * (a * p->n + b) + i] * q[a] * q[b];
      }
    }
  }
}

/* Accelerations of a free body by a set of effects: Lagrange's equations in the frame of its mass center, where the
   momentum is zero, for sets of few effects are not the same in frames that fly; O is where the mass center leaves
   it. */
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

/* E8.4 to E8.6, E8.12, E8.17, E8.19: each effect alone and together. */
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
      FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, NULL), FB_OK);
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

/* ---- as many coordinates, nodes and loads as there can be */

/* E8.39: what limits a deflection: how far out the farthest particle is, and how far each mode moves the one that it
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
    FBT_NEAR_REL(shape.second.reach[a], reach[a], FBT_TOL(1e-14, 1e-6));
  }
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(1.0), center, inertia), FB_OK); /* 13 m away */
  memset(&level, 0, sizeof level);
  level.effects = FB_EFFECTS_FULL;
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
  FBT_NEAR_REL(shape.size, 13.0, FBT_TOL(1e-14, 1e-6));
  FBT_NEAR_REL(body.deflection_limit, 6.5, FBT_TOL(1e-14, 1e-6)); /* half of it */
  FBT_TRUE(memcmp(body.reach, shape.second.reach, sizeof(fb_real) * (size_t)n) == 0);
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

/* Interface: a pair's integrals go to both its places, a coordinate's with itself to its own, once; what is not given
   is none. */
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
        FBT_TRUE(shape.second.pchi[3 * ij + x % 3] == (here && which == 0 ? p[x % 3] : FB_R(0.0)));
        FBT_TRUE(shape.second.hchi[3 * ij + x % 3] == (here && which == 1 ? h[x % 3] : FB_R(0.0)));
        FBT_TRUE(shape.second.Gamchi[9 * ij + x] == (here && which == 2 ? G[x] : FB_R(0.0)));
      }
    }
  }
}

SUITE(body_particles, RUN(coordinates_have_any_unit), RUN(size_and_reach_are_those_of_the_particles),
      RUN(integrals_of_a_pair_stand_in_both_places), RUN(accelerations_agree_with_a_particle_model),
      RUN(momenta_agree_with_a_particle_model), RUN(elastic_forces_agree_with_a_particle_model),
      RUN_LONG(each_set_of_effects_follows_its_own_lagrangian), RUN(bodies_do_not_depend_on_the_units))
