/* rigid_rotor.h - a rotor of articulated blades in hover by closed forms: rigid blades at small angles, momentum
   theory, the coning of a blade that bends. */
#ifndef RIGID_ROTOR_H
#define RIGID_ROTOR_H
#include <math.h>

#ifndef ROTOR_BLADES
#define ROTOR_BLADES 4 /* 3 or more */
#endif
enum { BLADES = ROTOR_BLADES, STRIPS = 4 }; /* of air on each blade */
static const double pi = 3.14159265358979324, degree = 3.14159265358979324 / 180.0;

/* [rad] Blade k is ahead of blade 0 by so much. */
static inline double blade_azimuth(int k)
{
  return 2 * pi * k / BLADES;
}

typedef struct rotor_data {
  double spin, radius, offset;               /* [rad/s], [m], [m] of the flap and lag hinges */
  double mass, ei_flap, ei_lag;              /* [kg/m], [N m^2] of a blade */
  double flap_spring, lag_damper;            /* [N m/rad], [N m s/rad] on the hinges */
  double chord, lift_slope, drag;            /* [m], [1/rad], drag coefficient of the profile */
  double density, inflow;                    /* [kg/m^3], [m/s] downward, uniform */
  double collective, cyclic_cos, cyclic_sin; /* [deg] */
} rotor_data;

/* The strips reach from a fifth of the radius, or the hinge, to the tip. */
static inline double strip_width(const rotor_data *o)
{
  return (o->radius - fmax(o->offset, 0.2 * o->radius)) / STRIPS;
}

static inline double strip_radius(const rotor_data *o, int i)
{
  return o->radius - (STRIPS - i - 0.5) * strip_width(o);
}

/* A blade about its hinge, beta'' I + c beta' + I Omega^2 nu^2 beta = g_pitch theta - g_inflow V. */
typedef struct blade_numbers {
  double I, nu, c, g_pitch, g_inflow; /* [kg m^2], -, [N m s], [N m], [N s] */
} blade_numbers;

static inline blade_numbers closed_form(const rotor_data *o)
{
  const double L = o->radius - o->offset, S = o->mass * L * L / 2, W = o->spin;
  const double lift = 0.5 * o->density * o->chord * strip_width(o) * o->lift_slope; /* per U_T (U_T theta - U_P) */
  const double drag = 0.5 * o->density * o->chord * strip_width(o) * o->drag;
  blade_numbers b = {0};
  b.I = o->mass * L * L * L / 3;
  b.nu = sqrt(1 + o->offset * S / b.I + o->flap_spring / (b.I * W * W));
  for (int i = 0; i < STRIPS; i++) {
    const double r = strip_radius(o, i), x = r - o->offset; /* U_T = W r, U_P = x beta' + V */
    b.c += (lift + drag) * W * r * x * x;
    b.g_pitch += lift * W * W * r * r * x;
    b.g_inflow += (lift + drag) * W * r * x;
  }
  return b;
}

/* Momentum theory: thrust = 2 rho pi R^2 V^2, by bisection. */
static inline double hover_inflow(const rotor_data *o)
{
  const double lift = 0.5 * o->density * o->chord * strip_width(o) * o->lift_slope, W = o->spin;
  double low = 0, high = 100;
  for (int k = 0; k < 60; k++) {
    const double V = 0.5 * (low + high);
    double thrust = 0;
    for (int i = 0; i < STRIPS; i++) {
      const double r = strip_radius(o, i);
      thrust += BLADES * lift * W * r * (W * r * o->collective * degree - V);
    }
    *(thrust > 2 * o->density * pi * o->radius * o->radius * V * V ? &low : &high) = V;
  }
  return low;
}

/* Coning by the tip of a flexible blade. Under its tension T = m W^2 (R^2 - r^2)/2 and the force F of the strips
   further out its slope w obeys  EI w'' - T w + F = 0,  EI w' = k w at the hinge, w' = 0 at the tip: by finite
   differences, eliminated from the tip to the hinge. */
static inline double flexible_coning(const rotor_data *o)
{
  enum { N = 2000 };
  static double w[N + 1], c[N + 1], d[N + 1]; /* w_j = c_j w_(j-1) + d_j */
  const double half = 0.5 * o->density * o->chord * strip_width(o), W = o->spin, R = o->radius;
  const double h = (R - o->offset) / N, g = o->ei_flap / (h * h);
  double height = 0;
  for (int j = N; j >= 0; j--) {
    const double r = o->offset + j * h, T = 0.5 * o->mass * W * W * (R * R - r * r);
    const double spring = j == 0 ? 2 * o->flap_spring / h : 0; /* w_(-1) = w_1 - 2 h k w_0/EI */
    const double out = j == N ? 0 : j == 0 ? 2 * g : g, in = j == N ? 2 * g : j == 0 ? 0 : g;
    double F = 0;
    for (int i = 0; i < STRIPS; i++) {
      const double s = strip_radius(o, i), part = (s - r) / h + 0.5; /* of a strip within half a mesh width */
      const double lift = o->lift_slope * (W * s * o->collective * degree - o->inflow) - o->drag * o->inflow;
      F += half * W * s * lift * fmax(0, fmin(1, part));
    }
    d[j] = 2 * g + T + spring - (j < N ? out * c[j + 1] : 0);
    c[j] = in / d[j];
    d[j] = (F + (j < N ? out * d[j + 1] : 0)) / d[j];
  }
  for (int j = 0; j <= N; j++) {
    w[j] = d[j] + (j > 0 ? c[j] * w[j - 1] : 0);
    height += (j == 0 || j == N ? 0.5 : 1) * h * w[j];
  }
  return height / (R - o->offset);
}

typedef struct disc { /* [rad] multiblade coordinates */
  double coning, tilt_cos, tilt_sin, differential;
} disc;

typedef struct answer {
  disc disc;                         /* mean over the last revolution */
  double lag, thrust, torque;        /* [rad], [N], [N m] the same */
  double gain, phase;                /* of the tilt to the cyclic pitch, [rad] behind it */
  double energy_miss, momentum_miss; /* relative to the shaft's work and angular impulse */
} answer;

/* Tilt by cyclic pitch, both as complex amplitudes c - i s of exp(i psi). */
static inline void relate(answer *a, const rotor_data *o)
{
  const double pitch = hypot(o->cyclic_cos, o->cyclic_sin) * degree;
  const double lead = atan2(-a->disc.tilt_sin, a->disc.tilt_cos) - atan2(-o->cyclic_sin, o->cyclic_cos);
  a->gain = pitch > 0 ? hypot(a->disc.tilt_cos, a->disc.tilt_sin) / pitch : 0;
  a->phase = pitch > 0 ? -atan2(sin(lead), cos(lead)) : 0;
}

/* The same of rigid blades with the lag hinge locked: beta_1 = g theta_1 / (I Omega^2 (nu^2 - 1) + i c Omega). */
static inline answer expected(const rotor_data *o)
{
  const blade_numbers b = closed_form(o);
  const double W = o->spin, re = b.I * W * W * (b.nu * b.nu - 1), im = b.c * W, size = b.g_pitch / (re * re + im * im);
  const double c = o->cyclic_cos * degree, s = o->cyclic_sin * degree; /* (c - i s)(re - i im) */
  answer a = {0};
  a.disc.coning = (b.g_pitch * o->collective * degree - b.g_inflow * o->inflow) / (b.I * W * W * b.nu * b.nu);
  a.disc.tilt_cos = size * (c * re - s * im);
  a.disc.tilt_sin = size * (s * re + c * im);
  relate(&a, o);
  return a;
}
#endif
