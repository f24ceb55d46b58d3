/* body.h - bodies of random particles and a boom with everything on it, shared by the tests of >>body and >>assemble:
   shape integrals, momentum form, effects, loads, nodes, energy. The judge is a brute-force model of particles that
   knows nothing of momenta or shape integrals: positions r + psi q + 1/2 chi q q, Newton's law per particle. */
#ifndef FBT_BODY_H
#define FBT_BODY_H

#include "fbt.h"

#define PARTICLES 30
#define MAX_N 8

typedef struct particles {
  int n;
  double m[PARTICLES], r[PARTICLES][3], psi[PARTICLES][MAX_N][3], chi[PARTICLES][MAX_N][MAX_N][3];
} particles;

/* As the library sees it. */
static inline double rounded(double x)
{
  return (double)(fb_real)x;
}

/* Random masses, places and modes; quadratic: random symmetric chi. */
static inline void particles_random(particles *p, int n, int quadratic)
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

static inline void particles_to_shape(fb_shape *shape, const particles *p)
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

static inline void velocity_random(velocity *s, int n, double deflection)
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

static inline void cross(double c[3], const double a[3], const double b[3])
{
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

/* Position, its variation J (n x 3) and velocity of particle i, body axes. */
static inline void particle_at(double x[3], double J[MAX_N][3], double xd[3], const particles *p, int i,
                               const velocity *s)
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

static fb_body body;
static const fb_form_body *formed; /* whose tables `body` has, in another form; NULL: it moves as a body */
static fb_body_work body_work;
static fb_shape shape;
static particles cloud;

static inline void state_from(fb_state *state, const fb_body *b, const velocity *s)
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

/* ---- every set of effects against its own Lagrangian, formed from the particles without shape integrals */

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

/* ---- a boom with everything on it */

static fb_beam_desc beam_desc;
static fb_beam beam;
static fb_modes modes;
static fb_modes_work modes_work;
#define BOOM_MODES 7

/* Rigid hub, boom off its axis in a skew direction with an offset tip body, bending, stretch and torsion modes, two
   nodes. */
static inline void boom(fb_shape *out, int node[2])
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

static inline void boom_body(unsigned effects, fb_base base, int node[2])
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
  fbt_fit(&desc);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &desc), FB_OK);
}

#define LARGE FB_MAX_MODES

/* Rows of `width` numbers, one of each of as many coordinates as there can be, for other coordinates: a mirror image in
   all of them, each in a unit of its own. */
static inline void combine(fb_real *x, int width)
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
static inline void combine_state(fb_real *q)
{
  combine(q, 1);
  for (int a = 0; a < LARGE; a++) {
    q[a] = (fb_real)ldexp((double)q[a], -2 * (a % 4));
  }
}

#define BODY_EVAL(what, ...) (formed ? fb_form_##what(formed, __VA_ARGS__) : fb_body_##what(&body, __VA_ARGS__))

/* A moving, deflected state; deflection of the modes of about size. Combined: the same in those other coordinates. */
static inline void moving_state(fb_state *state, double size, int combined)
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
  FBT_INT_EQ(formed ? fb_form_state_from_velocity(formed, state, v, w, qd)
                    : fb_state_from_velocity(&body, state, v, w, qd),
             FB_OK);
}

static inline void boom_state(fb_state *state, double size)
{
  moving_state(state, size, 0);
}

/* out = state + h rate */
static inline void state_along(fb_state *out, const fb_state *state, const fb_state *rate, double h)
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
static inline double power_of(const fb_state *state, const fb_input *input)
{
  fb_motion motion;
  double power = 0.0;
  FBT_INT_EQ(BODY_EVAL(motion_eval, &motion, state, input), FB_OK);
  for (int i = 0; i < input->n_load; i++) {
    const fb_load *load = &input->load[i];
    fb_real R[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, F[3], T[3];
    fb_node_motion at;
    FBT_INT_EQ(fb_body_node_motion_eval(&body, &at, state, &motion, load->node), FB_OK);
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
static inline double energy_rate(const fb_state *state, const fb_input *input, double h)
{
  fb_state rate, ahead, behind;
  fb_energy up, down;
  FBT_INT_EQ(BODY_EVAL(rates_eval, &rate, state, input), FB_OK);
  state_along(&ahead, state, &rate, h);
  state_along(&behind, state, &rate, -h);
  FBT_INT_EQ(BODY_EVAL(energy_eval, &up, &ahead, NULL), FB_OK);
  FBT_INT_EQ(BODY_EVAL(energy_eval, &down, &behind, NULL), FB_OK);
  return ((double)(up.kinetic - down.kinetic) + (double)(up.strain - down.strain) +
          (double)(up.gravity - down.gravity)) /
         (2.0 * h);
}

#endif
