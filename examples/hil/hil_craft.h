/* hil_craft.h - the spacecraft of hil_plant and hil_controller, as its data sheet has it, and what it is to do: both
   programs know these. A hub with three reaction wheels about its axes and two flexible arrays on drives. Include
   flexbeam.h and solar_array.h before. */
#ifndef HIL_CRAFT_H
#define HIL_CRAFT_H

static const double hub_mass = 300, hub_inertia[3] = {120, 100, 140}; /* [kg], [kg m^2] about its center, the origin */
static const solar_array arrays = {4, 1.5, 0.6, 10, 0.4, 0.005, 0.5};
static const double wheel_mass = 5, wheel_place = 0.3;             /* [kg], [m] from the origin, along its own axis */
static const double wheel_inertia = 0.05, wheel_transverse = 0.03; /* [kg m^2] about its axis, across it */
static const double wheel_friction = 1e-4;                         /* [N m s] */
static const double wheel_start = 60;                              /* [rad/s] of every wheel at the beginning */
static const double drive_friction = 0.2;                          /* [N m s] */
static const double slew_start = 2, slew_time = 20;                /* [s] */
static const double slew_angle = 0.35;                             /* [rad] of the hub about.. */
static const double slew_axis[3] = {0.8, 0.48, 0.36};              /* ..this axis of its own */
static const double drive_angle = 0.25;                            /* [rad] of the arrays in the same time */
static const double pointing_bound = 1.7e-4;                       /* [rad], 0.01 degrees.. */
static const double settling_time = 25;                            /* [s] ..that long after the slew */

/* Moments of inertia about the hub's axes, undeformed; of each wheel without the part about its own axis, which the
   motor turns against the hub. */
static inline void inertia_of_craft(double J[3])
{
  for (int i = 0; i < 3; i++) {
    J[i] = hub_inertia[i] + 2 * (wheel_transverse + wheel_mass * wheel_place * wheel_place);
  }
  solar_array_add_inertia(J, &arrays);
}

/* From 0 to 1 between slew_start and slew_start + slew_time: value, rate, acceleration; the rate is a versine. */
static inline void profile(double way[3], double t)
{
  const double turn = 2 * 3.14159265358979324 / slew_time;
  const double s = t < slew_start ? 0 : t > slew_start + slew_time ? slew_time : t - slew_start;
  way[0] = s / slew_time - sin(turn * s) / (2 * 3.14159265358979324);
  way[1] = (1 - cos(turn * s)) / slew_time;
  way[2] = turn * sin(turn * s) / slew_time;
}

/* Rotation (small) that brings attitude a to b, axes of a. */
static inline void turn_between(double turn[3], const fb_real a[4], const fb_real b[4])
{
  const fb_real back[4] = {a[0], -a[1], -a[2], -a[3]};
  fb_real q[4];
  fb_quat_mul(q, back, b);
  for (int i = 0; i < 3; i++) {
    turn[i] = (q[0] < 0 ? -2 : 2) * (double)q[i + 1];
  }
}

/* Where the hub should be at time t. */
static inline void wanted_attitude(fb_real quat[4], double t)
{
  double way[3];
  fb_real turn[3];
  profile(way, t);
  for (int i = 0; i < 3; i++) {
    turn[i] = (fb_real)(slew_angle * way[0] * slew_axis[i]);
  }
  fb_quat_from_rotvec(quat, turn);
}
#endif
