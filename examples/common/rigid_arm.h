/* rigid_arm.h - the textbook's arm of two links in a vertical plane, by closed forms: the torques that move it when it
   is rigid, its tip, and where the tip of bending links hangs. */
#ifndef RIGID_ARM_H
#define RIGID_ARM_H
#include <math.h>

enum { LINKS = 2 };
static const double gravity = 9.81; /* [m/s^2] along -y */

typedef struct link_data {
  double length, mass, EI; /* [m], [kg/m], [N m^2] */
  double tip_mass;         /* [kg] elbow motor, payload */
  double tip_inertia;      /* [kg m^2] of the elbow with its stator, of the payload */
  double rotor;            /* [kg m^2] motor and gear that turn with the link */
  double friction;         /* [N m s] of the joint */
  double Kp, Kd;           /* [N m/rad], [N m s/rad] */
  double from, to;         /* [rad] the elbow's angle is relative to the first link */
  double gain;             /* [1/(N m s)] of the strain damping */
} link_data;

typedef struct demand {
  double angle[LINKS], rate[LINKS], acceleration[LINKS];
} demand;

/* Torques that move the rigid arm as demanded, M th'' + h + G + friction: the textbook's two-link arm. */
static inline void rigid_torques(double tau[LINKS], const link_data arm[LINKS], const demand *d)
{
  const double l = arm[0].length, l2 = arm[1].length;
  const double m2 = arm[1].mass * l2 + arm[1].tip_mass;            /* [kg] */
  const double c2 = l2 * (arm[1].mass * l2 / 2 + arm[1].tip_mass); /* [kg m] about the elbow */
  const double J2 =
      l2 * l2 * (arm[1].mass * l2 / 3 + arm[1].tip_mass) + arm[1].rotor + arm[1].tip_inertia; /* [kg m^2] */
  const double c1 = l * (arm[0].mass * l / 2 + arm[0].tip_mass + m2);
  const double J1 = l * l * (arm[0].mass * l / 3 + arm[0].tip_mass + m2) + arm[0].rotor + arm[0].tip_inertia;
  const double c = cos(d->angle[1]), s = sin(d->angle[1]);
  const double w = d->rate[0], u = d->rate[1], a = d->acceleration[0], b = d->acceleration[1];
  const double G2 = gravity * c2 * cos(d->angle[0] + d->angle[1]);
  tau[0] = (J1 + J2 + 2 * l * c2 * c) * a + (J2 + l * c2 * c) * b - l * c2 * s * u * (2 * w + u) +
           gravity * c1 * cos(d->angle[0]) + G2;
  tau[1] = (J2 + l * c2 * c) * a + J2 * b + l * c2 * s * w * w + G2;
  for (int i = 0; i < LINKS; i++) {
    tau[i] += arm[i].friction * d->rate[i];
  }
}

static inline void rigid_tip(double tip[2], const link_data arm[LINKS], const double angle[LINKS])
{
  const double sum = angle[0] + angle[1];
  tip[0] = arm[0].length * cos(angle[0]) + arm[1].length * cos(sum);
  tip[1] = arm[0].length * sin(angle[0]) + arm[1].length * sin(sum);
}

/* Where the tip hangs at rest: each link a cantilever under its own weight q, the force F and moment T at its tip,
     u = (F/3 + M/(2 L) + q L/8) L^3/EI,  phi = (F/2 + M/L + q L/6) L^2/EI;  across the bent link, which turns the
     next. */
static inline void sagging_tip(double tip[2], const link_data arm[LINKS], const double angle[LINKS])
{
  double direction = 0;
  tip[0] = tip[1] = 0;
  for (int i = 0; i < LINKS; i++) {
    const link_data *d = &arm[i];
    const double beyond = i == 0 ? arm[1].mass * arm[1].length + arm[1].tip_mass : 0;
    const double lever = arm[1].length * (arm[1].mass * arm[1].length / 2 + arm[1].tip_mass);
    const double at = direction + angle[i], g = -gravity * cos(at), L = d->length;
    const double F = g * (d->tip_mass + beyond), q = g * d->mass;
    const double T = i == 0 ? -gravity * lever * cos(at + angle[1]) : 0;
    const double u = (F / 3 + T / (2 * L) + q * L / 8) * L * L * L / d->EI;
    const double phi = (F / 2 + T / L + q * L / 6) * L * L / d->EI;
    tip[0] += L * cos(at) - u * sin(at);
    tip[1] += L * sin(at) + u * cos(at);
    direction = at + phi;
  }
}
#endif
