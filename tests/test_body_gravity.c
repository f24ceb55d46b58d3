/* >>body: gravity of a center. The judge is the sum over particles of an inverse-square field, slopes of the potential,
   closed forms of orbits and librations, and what is conserved. */
#include "body.h"

static fb_body_desc desc;
static fb_state state, rate, before;
static fb_rk4_work rk4;
static fb_implicit_work implicit;
static fb_exponential exponential;
static fb_exponential_work exponential_work;
static fb_body without;

static void fresh(unsigned effects, fb_base base, double mu)
{
  memset(&desc, 0, sizeof desc);
  desc.effects = effects;
  desc.base = base;
  desc.mu = (fb_real)mu;
}

static void make(void)
{
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
  FBT_INT_EQ(fb_body_check(&body), FB_OK);
}

/* A rigid body with these moments of inertia about its mass center, that at c. */
static void rigid(double mass, const double c[3], double jx, double jy, double jz)
{
  const fb_real center[3] = {(fb_real)c[0], (fb_real)c[1], (fb_real)c[2]};
  const fb_real inertia[6] = {(fb_real)jx, (fb_real)jy, (fb_real)jz, 0, 0, 0};
  FBT_INT_EQ(fb_shape_init(&shape, 0), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, (fb_real)mass, center, inertia), FB_OK);
  make();
}

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Force on the mass center, torque about it and modal forces relative to it [about: 1, to O: 0] of a field of the
   center on each particle, inertial axes, at an attitude R and rho of O. */
static void particles_pulled(double F[3], double T[3], double f[MAX_N], const particles *p, const velocity *s,
                             const double R[9], const double rho[3], double mu, int about)
{
  double mass = 0.0, c[3] = {0}, dc[MAX_N][3] = {{0}}, J[MAX_N][3], unused[3], x[3];
  memset(F, 0, 3 * sizeof *F);
  memset(T, 0, 3 * sizeof *T);
  memset(f, 0, MAX_N * sizeof *f);
  for (int i = 0; i < PARTICLES; i++) {
    particle_at(x, J, unused, p, i, s);
    mass += p->m[i];
    for (int k = 0; k < 3; k++) {
      c[k] += p->m[i] * x[k];
      for (int a = 0; a < p->n; a++) {
        dc[a][k] += p->m[i] * J[a][k];
      }
    }
  }
  for (int i = 0; i < PARTICLES; i++) {
    double at[3], arm[3], pull[3], own[3], turn[3], d;
    particle_at(x, J, unused, p, i, s);
    for (int k = 0; k < 3; k++) {
      at[k] = rho[k] + dot(R + 3 * k, x);
    }
    d = sqrt(dot(at, at));
    for (int k = 0; k < 3; k++) {
      pull[k] = -mu * p->m[i] * at[k] / (d * d * d);
      F[k] += pull[k];
      own[k] = x[k] - (about ? c[k] / mass : 0.0);
    }
    for (int k = 0; k < 3; k++) {
      arm[k] = dot(R + 3 * k, own);
    }
    cross(turn, arm, pull);
    for (int k = 0; k < 3; k++) {
      T[k] += turn[k];
    }
    for (int a = 0; a < p->n; a++) {
      for (int k = 0; k < 3; k++) {
        const double of = R[k] * pull[0] + R[3 + k] * pull[1] + R[6 + k] * pull[2];
        f[a] += of * (J[a][k] - (about ? dc[a][k] / mass : 0.0));
      }
    }
  }
}

/* E8.36, E8.37: what the second degree leaves out of the sum over particles falls by the next power of size over
   distance: of the force as d^-5, of torque and modal forces as d^-4; of bases that feel the force itself, d^-5 also. */
TEST(a_center_pulls_as_the_sum_over_particles)
{
  static const fb_base base[3] = {FB_BASE_FREE, FB_BASE_PINNED, FB_BASE_PRESCRIBED};
  velocity s;
  memset(&s, 0, sizeof s);
  particles_random(&cloud, 3, 0);
  for (int a = 0; a < cloud.n; a++) {
    s.q[a] = rounded(0.3 * fbt_random());
  }
  particles_to_shape(&shape, &cloud);
  for (int k = 0; k < 3; k++) {
    double error[2][3] = {{0}}, size[3] = {0};
    for (int far = 0; far < 2; far++) {
      const double d = far ? 80.0 : 40.0, mu = 1000.0;
      const fb_real center[3] = {FB_R(3.0), -FB_R(2.0), FB_R(1.0)};
      double F[3], T[3], f[MAX_N], R[9], rho[3] = {0.6 * d, -0.48 * d, 0.64 * d};
      fb_real own[9];
      fresh(FB_EFFECTS_FULL, base[k], mu);
      memcpy(desc.center, center, sizeof center);
      make();
      state_from(&state, &body, &s);
      state.quat[0] = FB_R(0.5);
      state.quat[1] = -FB_R(0.7);
      state.quat[2] = FB_R(0.1);
      state.quat[3] = FB_R(0.5);
      FBT_INT_EQ(fb_quat_normalize(state.quat), FB_OK);
      fb_quat_to_mat33(own, state.quat);
      for (int i = 0; i < 9; i++) {
        R[i] = (double)own[i];
      }
      for (int i = 0; i < 3; i++) {
        state.rho[i] = (fb_real)(rho[i] + (double)center[i]);
      }
      particles_pulled(F, T, f, &cloud, &s, R, rho, mu, k == 0);
      FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, NULL), FB_OK);
      for (int i = 0; i < 3 && k == 0; i++) {
        error[far][0] = fmax(error[far][0], fabs((double)rate.u[i] * (double)body.mass - F[i]));
        size[0] = fmax(size[0], fabs(F[i]));
      }
      for (int i = 0; i < 3 && k < 2; i++) {
        error[far][1] = fmax(error[far][1], fabs((double)rate.L[i] - T[i]));
        size[1] = fmax(size[1], fabs(T[i]));
      }
      for (int a = 0; a < 3; a++) {
        error[far][2] = fmax(error[far][2], fabs((double)rate.pi[a] - f[a]));
        size[2] = fmax(size[2], fabs(f[a]));
      }
    }
    for (int i = 0; i < 3; i++) {
      if (size[i] > 0.0) {
        FBT_BELOW(error[0][i], FBT_TOL(k > 0 ? 5e-3 : i > 0 ? 0.2 : 1e-3, 0.2) * size[i]);
        if (!FB_SINGLE) {
          FBT_NEAR_REL(error[0][i] / error[1][i], i == 0 ? 32.0 : 16.0, 0.25);
        }
      }
    }
  }
}

/* Potential at a state of a body whose base is prescribed. */
static double potential(const fb_state *at)
{
  fb_energy energy;
  FBT_INT_EQ(fb_body_energy_eval(&body, &energy, at, NULL), FB_OK);
  return (double)energy.gravity;
}

/* E8.36: -dU/dq at fixed O and attitude, of polynomial modes, axial coordinates, and lines. */
TEST(modal_forces_of_a_center_are_the_slope_of_the_energy)
{
  static const unsigned set[] = {FB_EFFECTS_FULL, FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA, FB_EFFECTS_LARGE};
  for (int k = 0; k < FBT_COUNT(set) - (FB_WITH_LARGE_DEFLECTION ? 0 : 1); k++) {
    int node[2];
    fb_state at;
    fb_real free_rate[FB_MAX_MODES];
    double worst = 0.0, size = 0.0;
    boom(&shape, node);
    fresh(set[k], FB_BASE_PRESCRIBED, 0.0);
    desc.allow_split_effects = 1;
    make();
    without = body;
    desc.mu = FB_R(500.0);
    make();
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    fbt_fill(state.quat, 4, 1.0);
    FBT_INT_EQ(fb_quat_normalize(state.quat), FB_OK);
    state.rho[0] = FB_R(9.0);
    state.rho[2] = -FB_R(12.0);
    fbt_fill(state.q, body.n, 0.05);
    FBT_INT_EQ(fb_body_rates_eval(&without, &rate, &state, NULL), FB_OK);
    memcpy(free_rate, rate.pi, sizeof free_rate);
    FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, NULL), FB_OK);
    for (int a = 0; a < body.n; a++) {
      const double h = FBT_TOL(1e-3, 0.02);
      double slope[2];
      for (int j = 0; j < 2; j++) {
        at = state;
        at.q[a] = (fb_real)((double)state.q[a] + (1 + j) * h);
        slope[j] = potential(&at);
        at.q[a] = (fb_real)((double)state.q[a] - (1 + j) * h);
        slope[j] = (slope[j] - potential(&at)) / (2.0 * (1 + j) * h);
      }
      slope[0] = (4.0 * slope[0] - slope[1]) / 3.0;
      worst = fmax(worst, fabs((double)rate.pi[a] - (double)free_rate[a] + slope[0]));
      size = fmax(size, fabs(slope[0]));
    }
    FBT_TRUE(size > 0.1);
    FBT_BELOW(worst, FBT_TOL(1e-9, 1e-2) * size);
  }
}

/* Velocity of O, and of the body about it, with which the mass center (at c from O, body axes) moves at u. */
static void launch(const double c[3], const double w[3], const double position[3], const double u[3])
{
  fb_real v[3], own[3], turn[9];
  double arm[3], along[3];
  fb_quat_to_mat33(turn, state.quat);
  cross(along, w, c);
  for (int i = 0; i < 3; i++) {
    arm[i] = (double)turn[3 * i] * c[0] + (double)turn[3 * i + 1] * c[1] + (double)turn[3 * i + 2] * c[2];
    state.rho[i] = (fb_real)(position[i] - arm[i]);
    own[i] = (fb_real)w[i];
  }
  for (int i = 0; i < 3; i++) {
    v[i] = (fb_real)((double)turn[i] * u[0] + (double)turn[3 + i] * u[1] + (double)turn[6 + i] * u[2] - along[i]);
  }
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, own, NULL), FB_OK);
}

/* E8.37: the field of a sphere has no second degree, its mass center moves on Kepler's ellipse: after T = 2 pi
   sqrt(a^3/mu) it is where it was; half of it later at the apocenter. O is off it and the body turns. */
TEST(spheres_fly_on_kepler_ellipses)
{
  const double mu = 3.986004418e14, a = 8e6, e = 0.2, T = 2.0 * acos(-1.0) * sqrt(a * a * a / mu);
  const double c[3] = {0.0, 1.0, 0.5}, w[3] = {2.0 / T, 3.0 / T, -5.0 / T};
  const double position[3] = {a * (1.0 - e), 0.0, 0.0};
  const double u[3] = {0.0, sqrt(mu / a * (1.0 + e) / (1.0 - e)) * 0.6, sqrt(mu / a * (1.0 + e) / (1.0 - e)) * 0.8};
  const int steps = 1200;
  fresh(0, FB_BASE_FREE, mu);
  rigid(400.0, c, 100.0, 100.0, 100.0);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  launch(c, w, position, u);
  for (int half = 1; half <= 2; half++) {
    fb_real turn[9];
    for (int k = 0; k < steps / 2; k++) {
      FBT_INT_EQ(fb_rk4_step(&body, &state, &rk4, NULL, NULL, NULL, (fb_real)(T / steps)), FB_OK);
    }
    fb_quat_to_mat33(turn, state.quat);
    for (int i = 0; i < 3; i++) {
      const double arm = (double)turn[3 * i] * c[0] + (double)turn[3 * i + 1] * c[1] + (double)turn[3 * i + 2] * c[2];
      const double goal = i > 0 ? 0.0 : half == 1 ? -a * (1.0 + e) : a * (1.0 - e);
      FBT_NEAR_ABS((double)state.rho[i] + arm, goal, FBT_TOL(0.05, 300.0)); /* [m] of 8e6 */
    }
  }
}

/* Samples x of a sum of undamped oscillations of these angles a step: what the polynomial with their roots leaves. */
static double residue(const double *x, int n, const double *angle, int n_angle)
{
  double p[5] = {1.0, 0.0, 0.0, 0.0, 0.0}, worst = 0.0;
  for (int k = 0; k < n_angle; k++) {
    double next[5] = {0.0};
    for (int i = 0; i <= 2 * k; i++) {
      next[i] += p[i];
      next[i + 1] -= 2.0 * cos(angle[k]) * p[i];
      next[i + 2] += p[i];
    }
    memcpy(p, next, sizeof p);
  }
  for (int i = 2 * n_angle; i < n; i++) {
    double sum = 0.0;
    for (int j = 0; j <= 2 * n_angle; j++) {
      sum += p[j] * x[i - j];
    }
    worst = fmax(worst, fabs(sum));
  }
  return worst;
}

/* E8.37: a rigid satellite on a circular orbit librates about the local vertical, in pitch at n sqrt(3 (J_r - J_y)/J_p),
   roll and yaw coupled: s^4 + (1 + 3 a + a b) n^2 s^2 + 4 a b n^4, a = (J_p - J_y)/J_r, b = (J_p - J_r)/J_y ([HS]
   9.2). r along the flight, p normal to the orbit, y along the radius. */
TEST(satellites_librate_at_the_frequencies_of_the_gradient)
{
  enum { SAMPLES = 40 };
  const int fine = FBT_TOL(80, 20);
  const double mu = 3.986004418e14, d = 7e6, n = sqrt(mu / (d * d * d)), Jr = 90.0, Jp = 110.0, Jy = 30.0;
  const double a = (Jp - Jy) / Jr, b = (Jp - Jr) / Jy, half = 0.5 * (1.0 + 3.0 * a + a * b);
  const double root = sqrt(half * half - 4.0 * a * b), c[3] = {0.0, 0.0, 0.0}, small = FBT_TOL(1e-5, 1e-2);
  const double position[3] = {d, 0.0, 0.0}, u[3] = {0.0, n * d, 0.0}, h = 0.4 / n; /* radius x, flight y, normal z */
  const double pitch = sqrt(3.0 * (Jr - Jy) / Jp), angle[2] = {sqrt(half + root) * n * h, sqrt(half - root) * n * h};
  const double alone = pitch * n * h, w[3] = {0.0, 0.0, n};
  double x[3][SAMPLES];
  fresh(0, FB_BASE_FREE, mu);
  rigid(400.0, c, Jy, Jr, Jp);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  for (int i = 0; i < 3; i++) {
    state.quat[1 + i] = (fb_real)(small * (1.0 + 0.3 * i));
  }
  FBT_INT_EQ(fb_quat_normalize(state.quat), FB_OK);
  launch(c, w, position, u);
  for (int k = 0; k < SAMPLES; k++) {
    const double t = k * h;
    const fb_real back[4] = {(fb_real)cos(0.5 * n * t), 0, 0, (fb_real)-sin(0.5 * n * t)};
    fb_real own[4];
    fb_quat_mul(own, back, state.quat);
    for (int i = 0; i < 3; i++) {
      x[i][k] = (double)own[1 + i] * (own[0] < FB_R(0.0) ? -1.0 : 1.0);
    }
    for (int j = 0; j < fine; j++) {
      FBT_INT_EQ(fb_rk4_step(&body, &state, &rk4, NULL, NULL, NULL, (fb_real)(h / fine)), FB_OK);
    }
  }
  FBT_BELOW(residue(x[2], SAMPLES, &alone, 1), FBT_TOL(3e-5, 0.05) * small);
  FBT_BELOW(residue(x[0], SAMPLES, angle, 2), FBT_TOL(3e-5, 0.05) * small);
  FBT_BELOW(residue(x[1], SAMPLES, angle, 2), FBT_TOL(3e-5, 0.05) * small);
}

/* Energy and angular momentum about the center of the field. */
static double conserved(double L[3])
{
  fb_energy energy;
  fb_momentum momentum;
  double p[3], turn[3], center[3];
  FBT_INT_EQ(fb_body_energy_eval(&body, &energy, &state, NULL), FB_OK);
  FBT_INT_EQ(fb_body_momentum_eval(&body, &momentum, &state, NULL), FB_OK);
  for (int i = 0; i < 3; i++) {
    p[i] = (double)momentum.linear[i];
    center[i] = (double)body.center[i];
  }
  cross(turn, center, p);
  for (int i = 0; i < 3; i++) {
    L[i] = (double)momentum.angular[i] - turn[i];
  }
  return (double)energy.kinetic + (double)energy.strain + (double)energy.gravity;
}

static fb_status step(int integrator, double dt)
{
  switch (integrator) {
  case FB_INTEGRATOR_MIDPOINT:
    return fb_midpoint_step(&body, &state, &implicit, NULL, (fb_real)dt, 4);
  case FB_INTEGRATOR_SDIRK:
    return fb_sdirk_step(&body, &state, &implicit, NULL, NULL, (fb_real)dt, 4);
  case FB_INTEGRATOR_EXPONENTIAL:
    return fb_exponential_step(&body, &exponential, &state, &exponential_work, NULL, NULL, NULL);
  default:
    return fb_rk4_step(&body, &state, &rk4, NULL, NULL, NULL, (fb_real)dt);
  }
}

/* A boom close to a strong center, bent and turning; rotors: wheels on the hub and at the tip. */
static void close_by(unsigned effects, int rotors)
{
  int node[2];
  const fb_real v[3] = {FB_R(1.0), FB_R(4.0), -FB_R(1.5)}, w[3] = {FB_R(0.3), -FB_R(0.2), FB_R(0.4)};
  boom(&shape, node);
  fresh(effects, FB_BASE_FREE, 700.0);
  desc.center[0] = FB_R(5.0);
  desc.center[1] = -FB_R(3.0);
#if FB_WITH_ROTORS
  desc.n_rotor = rotors;
  for (int r = 0; r < rotors; r++) {
    desc.rotor[r].node = r ? node[0] : 0;
    desc.rotor[r].axis[r] = FB_R(1.0);
    desc.rotor[r].inertia = FB_R(0.2);
  }
#endif
  make();
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  state.rho[0] = FB_R(17.0);
  state.rho[2] = FB_R(14.0);
  for (int i = 0; i < body.n; i++) {
    state.q[i] = (fb_real)(0.05 * fbt_random());
  }
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, w, NULL), FB_OK);
  (void)rotors;
}

/* E8.36, E8.37: with every integrator, of polynomial modes, lines and rotors. */
TEST(a_center_keeps_energy_and_angular_momentum)
{
  static const unsigned set[] = {FB_EFFECTS_FULL, FB_EFFECTS_LARGE};
  for (int k = 0; k < (FB_WITH_LARGE_DEFLECTION ? 2 : 1); k++) {
    for (int rotors = 0; rotors <= 2 * FB_WITH_ROTORS; rotors += 2) {
      double L[3], L_0[3], E, E_0, gain[2];
      for (int j = 0; j < 2; j++) {
        const double dt = FBT_TOL(0.002, 0.004) / (1 + j);
        fbt_seed(3);
        close_by(set[k], rotors);
        E_0 = conserved(L_0);
        for (int i = 0; i < 500 * (1 + j); i++) {
          FBT_INT_EQ(step(FB_INTEGRATOR_RK4, dt), FB_OK);
        }
        E = conserved(L);
        gain[j] = fabs(E - E_0);
        FBT_BELOW(gain[j], FBT_TOL(1e-7, 1e-3) * fabs(E_0));
        for (int i = 0; i < 3; i++) {
          FBT_NEAR_ABS(L[i], L_0[i], FBT_TOL(1e-8, 1e-4) * sqrt(dot(L_0, L_0)));
        }
      }
      FBT_TRUE(FB_SINGLE || gain[0] > 10.0 * gain[1] || gain[0] < 1e-12 * fabs(E_0));
    }
  }
}

/* E11.3, E11.7, E11.8, E11.10 with a center: the other integrators come to where rk4 does, as their order says. */
TEST(integrators_agree_on_a_center)
{
  static const int integrator[] = {FB_INTEGRATOR_MIDPOINT, FB_INTEGRATOR_SDIRK, FB_INTEGRATOR_EXPONENTIAL};
  static const unsigned set[] = {FB_EFFECTS_FULL, FB_EFFECTS_LARGE};
  for (int k = 0; k < (FB_WITH_LARGE_DEFLECTION ? 2 : 1); k++) {
    fbt_seed(3);
    close_by(set[k], 0);
    for (int i = 0; i < 1000; i++) {
      FBT_INT_EQ(step(FB_INTEGRATOR_RK4, 0.0004), FB_OK);
    }
    before = state;
    for (int j = 0; j < 3; j++) {
      double error[2];
      for (int fine = 0; fine < 2; fine++) {
        const double dt = (fine ? 0.0005 : 0.001);
        fbt_seed(3);
        close_by(set[k], 0);
        FBT_INT_EQ(fb_exponential_init(&exponential, &body_work, &body, (fb_real)dt), FB_OK);
        for (int i = 0; i < (fine ? 800 : 400); i++) {
          FBT_INT_EQ(step(integrator[j], dt), FB_OK);
        }
        error[fine] = fbt_difference(state.rho, before.rho, 3) + fbt_difference(state.quat, before.quat, 4) +
                      fbt_difference(state.q, before.q, body.n);
        FBT_BELOW(error[fine], FBT_TOL(1e-3, 2e-3));
      }
      FBT_TRUE(FB_SINGLE || error[1] < 0.3 * error[0] || error[0] < 1e-9);
    }
  }
}

/* E8.36, closed form: a uniform boom along the vertical on a heavy hub, on a circular orbit and turning with it, bears
   the tension 3 n^2 m' (L^2 - x^2)/2, of which the gradient is two thirds: its tip moves out by n^2 m' L^3/EA. */
TEST(the_gradient_stretches_a_boom)
{
  const double mu = 8e7, d = 2e4, n = sqrt(mu / (d * d * d)), length = 10.0, per_length = 2.0, EA = 10.0;
  const fb_real none[3] = {0, 0, 0}, inertia[6] = {FB_R(1e6), FB_R(1e6), FB_R(1e6), 0, 0, 0};
  const double c[3] = {0, 0, 0}, w[3] = {0, 0, n}, position[3] = {d, 0, 0}, u[3] = {0, n * d, 0};
  double stretch[2] = {0.0, 0.0};
  int node;
  fb_modes_desc keep;
  memset(&keep, 0, sizeof keep);
  memset(&beam_desc, 0, sizeof beam_desc);
  beam_desc.length = (fb_real)length;
  beam_desc.n_element = 10;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = (fb_real)per_length;
  beam_desc.station[0].EA = (fb_real)EA;
  beam_desc.station[0].EI_y = beam_desc.station[0].EI_z = FB_R(100.0);
  keep.count[FB_KIND_AXIAL] = 8;
  FBT_INT_EQ(fb_beam_init(&beam, &beam_desc), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, FB_R(1e6), none, inertia), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, (fb_real)length), FB_OK);
  for (int turns = 0; turns < 2; turns++) {
    fresh(FB_EFFECTS_FULL, FB_BASE_FREE, mu);
    make();
    FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
    launch(c, turns ? w : c, position, u);
    FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, NULL), FB_OK);
    for (int a = 0; a < body.n; a++) {
      stretch[turns] += (double)shape.node[node].psi[3 * a] * (double)rate.pi[a] / (double)body.K.diagonal[a];
    }
  }
  FBT_NEAR_REL(stretch[1], n * n * per_length * length * length * length / EA, 1e-3);
  FBT_NEAR_REL(stretch[0], stretch[1] * 2.0 / 3.0, FBT_TOL(1e-4, 1e-3));
}

/* E9.20, E8.37: accelerometers of a satellite in free fall read zero at the mass center, elsewhere the difference of
   the field. */
TEST(accelerometers_read_the_difference_of_the_field)
{
  const double mu = 1e6, d = 400.0, g = mu / (d * d), c[3] = {0, 0, 0}, still[3] = {0, 0, 0};
  const double position[3] = {0.0, -d, 0.0};
  const fb_real arm[3] = {0, FB_R(2.0), 0};
  int node;
  fresh(0, FB_BASE_FREE, mu);
  rigid(100.0, c, 50.0, 50.0, 50.0);
  FBT_INT_EQ(fb_shape_add_node(&shape, &node, arm, NULL, NULL), FB_OK);
  make();
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  launch(c, still, position, still);
  for (int k = 0; k < 2; k++) {
    fb_motion motion;
    fb_node_motion at;
    fb_real own[3];
    fb_imu imu;
    FBT_INT_EQ(fb_body_motion_eval(&body, &motion, &state, NULL), FB_OK);
    FBT_INT_EQ(fb_body_node_motion_eval(&body, &at, &state, &motion, k ? node : 0), FB_OK);
    FBT_INT_EQ(fb_body_gravity_eval(&body, own, at.position), FB_OK);
    fb_imu_eval(&imu, &at, own);
    FBT_NEAR_ABS(at.acceleration[1], g, FBT_TOL(1e-13, 1e-6) * g);
    FBT_NEAR_ABS(imu.specific_force[0], 0.0, FBT_TOL(1e-13, 1e-6) * g);
    FBT_NEAR_ABS(imu.specific_force[1], k ? g - mu / ((d - 2.0) * (d - 2.0)) : 0.0, FBT_TOL(1e-13, 1e-6) * g);
  }
}

/* E8.36: refusals, and what mu = 0 leaves as it was. */
TEST(centers_refuse_what_they_do_not_know)
{
  static fb_form_body second;
  const fb_form_desc kind = {FB_FORM_SECOND, FB_TORQUE_IDENTITY, NULL};
  static const double c[3] = {0, 0, 0}, still[3] = {0, 0, 0};
  const double inside[3] = {1.0, 0.0, 0.0};
  fb_state kept;
  fb_real g[3], nan[3] = {0, 0, 0};
  int node[2];

  /* mu = 0: the same bytes */
  boom(&shape, node);
  fresh(FB_EFFECTS_FULL, FB_BASE_FREE, 0.0);
  make();
  without = body;
  desc.center[1] = FB_R(7.0);
  make();
  FBT_TRUE(memcmp(&without, &body, sizeof body) == 0);
  FBT_INT_EQ((int)(fb_body_crc(&without) - fb_body_crc(&body)), 0);

  /* descriptions */
  desc.mu = -FB_R(1.0);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_ERR_VALUE);
  desc.mu = FB_R(1.0);
  desc.center[1] = (fb_real)NAN;
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_ERR_NOT_FINITE);
  desc.center[1] = FB_R(0.0);
  desc.mu = (fb_real)NAN;
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_ERR_NOT_FINITE);
  desc.mu = FB_R(1.0);
  desc.effects = FB_EFFECTS_SPIN;
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_ERR_EFFECTS);
  desc.effects = FB_EFFECTS_FULL | FB_EFFECT_CENTRAL_GRAVITY;
  desc.mu = FB_R(0.0);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_ERR_EFFECTS);
  desc.mu = FB_R(1.0);
  FBT_INT_EQ(fb_form_init(&second, &body_work, &shape, &desc, &kind), FB_ERR_EFFECTS);

  /* the center inside the body, at its mass center, not finite: the state stays */
  fresh(0, FB_BASE_FREE, 5.0);
  rigid(10.0, c, 10.0, 10.0, 10.0); /* [m] root mean square 1.22 */
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  FBT_INT_EQ(fb_body_rates_eval(&body, &rate, &state, NULL), FB_ERR_RANGE);
  launch(c, still, inside, still);
  kept = state;
  FBT_INT_EQ(fb_rk4_step(&body, &state, &rk4, NULL, NULL, NULL, FB_R(0.01)), FB_ERR_RANGE);
  FBT_TRUE(memcmp(&kept, &state, sizeof state) == 0);
  state.rho[0] = FB_R(2.5);
  FBT_INT_EQ(fb_rk4_step(&body, &state, &rk4, NULL, NULL, NULL, FB_R(0.01)), FB_OK);
  state.rho[0] = (fb_real)NAN;
  FBT_INT_EQ(fb_rk4_step(&body, &state, &rk4, NULL, NULL, NULL, FB_R(0.01)), FB_ERR_NOT_FINITE);

  /* the field at its center, and nowhere */
  FBT_INT_EQ(fb_body_gravity_eval(&body, g, nan), FB_ERR_RANGE);
  nan[0] = (fb_real)NAN;
  FBT_INT_EQ(fb_body_gravity_eval(&body, g, nan), FB_ERR_NOT_FINITE);

  /* a step as long as the orbit */
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  state.rho[0] = FB_R(5.0);
  FBT_INT_EQ(fb_rk4_step(&body, &state, &rk4, NULL, NULL, NULL, FB_R(30.0)), FB_ERR_STEP);

  /* check word */
  node[0] = (int)fb_body_crc(&body);
  body.center[2] = FB_R(1.0);
  FBT_TRUE((int)fb_body_crc(&body) != node[0]);
  body.mu = -FB_R(1.0);
  FBT_INT_EQ(fb_body_check(&body), FB_ERR_VALUE);
}

SUITE(body_gravity, RUN(a_center_pulls_as_the_sum_over_particles),
      RUN(modal_forces_of_a_center_are_the_slope_of_the_energy), RUN(spheres_fly_on_kepler_ellipses),
      RUN(satellites_librate_at_the_frequencies_of_the_gradient), RUN(a_center_keeps_energy_and_angular_momentum),
      RUN_LONG(integrators_agree_on_a_center), RUN(the_gradient_stretches_a_boom),
      RUN(accelerometers_read_the_difference_of_the_field), RUN(centers_refuse_what_they_do_not_know))
