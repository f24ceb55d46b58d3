/* hil_control.h - the flight software: attitude and gyro bias estimated from gyros and star tracker, a slew with
   feedforward, PD with roll-off and a notch at the frequency at which hub and arrays swing, the array drives' loops.
   It sees sensor values and gives a command; hil_controller calls it behind packets, hil_plant, if asked to,
   directly. */
#ifndef HIL_CONTROL_H
#define HIL_CONTROL_H
#include "../common/filter.h"
#include "hil.h"
#include "hil_craft.h"

typedef struct estimate {
  int known;       /* the star tracker has been seen */
  double time;     /* [s] of the estimate */
  fb_real quat[4]; /* hub to inertial axes */
  double rate[3];  /* [rad/s] gyros less bias */
  double bias[3];
} estimate;

typedef struct controller {
  int ready;
  double J[3], kp[3], kd[3], swing; /* [kg m^2], [N m/rad], [N m s/rad], [rad/s] */
  filter roll_off[3], notch[3];
  double turning;                      /* [kg m^2] of an array about its drive */
  double drive_kp, drive_kd;           /* [N m/rad], [N m s/rad] */
  double drive_last[2], drive_rate[2]; /* [rad], [rad/s] filtered */
  estimate estimate;
} controller;

static const double bandwidth = 0.5, damping_ratio = 0.8;    /* [rad/s], of the attitude loop */
static const double roll_off = 3, drive_bandwidth = 2;       /* [rad/s] */
static const double drive_filter = 50, star_bandwidth = 0.3; /* [rad/s] */

/* The notch is designed by the model: the modes of an array, clamped. FB_ERR_...: there is no such model. */
static inline fb_status controller_init(controller *c)
{
  static fb_beam beam;
  static fb_modes modes;
  static fb_body body;
  int tip;
  const fb_status status = solar_array_init(&body, &tip, &beam, &modes, &arrays);
  memset(c, 0, sizeof *c);
  if (status != FB_OK) {
    return status;
  }
  inertia_of_craft(c->J);
  c->swing = solar_array_swing(&modes, &arrays, c->J[0]);
  for (int i = 0; i < 3; i++) {
    c->kp[i] = c->J[i] * bandwidth * bandwidth;
    c->kd[i] = 2 * damping_ratio * c->J[i] * bandwidth;
  }
  c->turning = arrays.fitting + arrays.mass * arrays.width * arrays.width / 12;
  c->drive_kp = c->turning * drive_bandwidth * drive_bandwidth;
  c->drive_kd = 2 * damping_ratio * c->turning * drive_bandwidth;
  return FB_OK;
}

/* With the first sensor values: they tell the period. */
static inline void controller_begin(controller *c, double t, const double *sensors)
{
  const double w = c->swing, r = roll_off, period = sensors[HIL_PERIOD];
  for (int i = 0; i < 3; i++) {
    filter_init(&c->roll_off[i], 0, 0, r * r, 2 * 0.7 * r, r * r, r, period);
    filter_init(&c->notch[i], 1, 2 * 0.02 * w, w * w, 2 * 0.5 * w, w * w, w, period);
  }
  for (int i = 0; i < 2; i++) {
    c->drive_last[i] = sensors[HIL_DRIVE + i];
    c->drive_rate[i] = 0;
  }
  memset(&c->estimate, 0, sizeof c->estimate);
  c->estimate.time = t;
  c->ready = 1;
}

/* Turns the estimate by an angle in its own axes. */
static inline void estimate_turn(estimate *e, const double angle[3])
{
  const fb_real turn[3] = {(fb_real)angle[0], (fb_real)angle[1], (fb_real)angle[2]};
  fb_real step[4], quat[4];
  fb_quat_from_rotvec(step, turn);
  fb_quat_mul(quat, e->quat, step);
  memcpy(e->quat, quat, sizeof quat);
  (void)fb_quat_normalize(e->quat); /* a product of unit quaternions is never zero */
}

/* Gyros turn the estimate, at the mean of the rates at both ends; each reading of the star tracker draws it and the
   bias like a critically damped observer. Time stamps, not packets, are what counts: some may be lost. */
static inline void estimate_step(estimate *e, double t, const double *sensors)
{
  const double dt = t - e->time, every = 0.1; /* [s] between readings of the star tracker */
  double angle[3], off[3];
  fb_real star[4];
  for (int i = 0; i < 3; i++) {
    const double rate = sensors[HIL_GYRO + i] - e->bias[i];
    angle[i] = 0.5 * dt * (rate + e->rate[i]);
    e->rate[i] = rate;
  }
  e->time = t;
  if (e->known) {
    estimate_turn(e, angle);
  }
  if (sensors[HIL_STAR_NEW] != 0) {
    for (int i = 0; i < 4; i++) {
      star[i] = (fb_real)sensors[HIL_STAR + i];
    }
    if (!e->known) {
      memcpy(e->quat, star, sizeof star);
      e->known = fb_quat_normalize(e->quat) == FB_OK;
      return;
    }
    turn_between(off, e->quat, star);
    for (int i = 0; i < 3; i++) {
      e->bias[i] -= star_bandwidth * star_bandwidth * every * off[i];
      off[i] *= 2 * star_bandwidth * every;
    }
    estimate_turn(e, off);
  }
}

/* Torque on the hub [N m]: J a + w x (J w + h) along the slew, h the angular momentum of the wheels; what the arrays'
   drives take; and the loop. */
static inline void attitude_loop(controller *c, double torque[3], double t, const double *sensors)
{
  const double *w = c->estimate.rate;
  double way[3], error[3], H[3];
  fb_real wanted[4];
  profile(way, t);
  wanted_attitude(wanted, t);
  turn_between(error, wanted, c->estimate.quat);
  for (int i = 0; i < 3; i++) {
    H[i] = c->J[i] * w[i] + wheel_inertia * (sensors[HIL_WHEEL + i] + w[i]);
  }
  for (int i = 0; i < 3; i++) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double rate = w[i] - slew_angle * way[1] * slew_axis[i];
    double u = -c->kp[i] * error[i] - c->kd[i] * rate;
    u = filter_step(&c->roll_off[i], u);
    u = filter_step(&c->notch[i], u);
    torque[i] = c->J[i] * slew_angle * way[2] * slew_axis[i] + w[j] * H[k] - w[k] * H[j] + u;
  }
  torque[1] += 2 * c->turning * drive_angle * way[2];
}

/* Torque of both array drives [N m]; both turn the same way about y of the hub. */
static inline void drive_loops(controller *c, double torque[2], double dt, double t, const double *sensors)
{
  double way[3];
  profile(way, t);
  for (int i = 0; i < 2; i++) {
    const double side = i == 0 ? 1 : -1, angle = sensors[HIL_DRIVE + i], wanted_rate = side * drive_angle * way[1];
    const double turn = side * (drive_angle + slew_angle * slew_axis[1]) * way[2]; /* [rad/s^2] of the array */
    if (dt > 0) {
      const double now = (angle - c->drive_last[i]) / dt;
      c->drive_rate[i] += drive_filter * dt / (1 + drive_filter * dt) * (now - c->drive_rate[i]);
    }
    c->drive_last[i] = angle;
    torque[i] = c->drive_kp * (side * drive_angle * way[0] - angle) + c->drive_kd * (wanted_rate - c->drive_rate[i]) +
                drive_friction * wanted_rate + c->turning * turn;
  }
}

/* The command [N m] that answers the sensors of time t [s]. Wheels stay as they are until the attitude is known. */
static inline void controller_step(controller *c, double command[HIL_COMMAND_VALUES], double t, const double *sensors)
{
  double dt, torque[3];
  if (!c->ready) {
    controller_begin(c, t, sensors);
  }
  dt = t - c->estimate.time;
  estimate_step(&c->estimate, t, sensors);
  memset(command, 0, HIL_COMMAND_VALUES * sizeof command[0]);
  drive_loops(c, command + HIL_DRIVE_TORQUE, dt, t, sensors);
  if (c->estimate.known) {
    attitude_loop(c, torque, t, sensors);
    for (int i = 0; i < 3; i++) { /* the wheel is pushed the other way, and against its friction */
      command[HIL_WHEEL_TORQUE + i] = wheel_friction * sensors[HIL_WHEEL + i] - torque[i];
    }
  }
  for (int i = 0; i < HIL_COMMAND_VALUES; i++) {
    command[i] = fmax(-hil_torque_limit[i], fmin(hil_torque_limit[i], command[i]));
  }
}
#endif
