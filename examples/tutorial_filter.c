/* tutorial_filter - an extended Kalman filter that sees a boom bend: from a gyro and a star tracker on the hub of the satellite
   of examples/satellite.txt it estimates attitude, rate and the modes of its wing, which nothing measures. It shows:
   the step with its Jacobian and the sensors with theirs, which `reduce --jacobian` has written, without the library;
   updates by one number at a time, so that no matrix is inverted. The craft that is observed is stepped by the library:
   a push bends its wing, the filter begins with the wing at rest and a wrong attitude.
   Check: errors below what is printed as bound, and of the size that the filter expects. Exit: 0 well, 1 not. */
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#include "satellite_model.h" /* model_step_jacobian, model_sense_O_jacobian: reduce --jacobian */
#include "satellite_true.h"  /* static const fb_body satellite: reduce */
#include <stdio.h>
#include <string.h>

enum { N = model_STATES, QUAT = 3, Q = 13 }; /* states: rho, quat, u, L, then q and pi */
static const double period = 0.01;           /* [s] of gyro and filter; the star tracker sees every 20th time */
static const double gyro_noise = 2e-5, star_noise = 5e-5; /* [rad/s], [rad], standard deviations */

static double x[N], P[N][N]; /* estimate, covariance */

/* Normally distributed, by twelve uniform numbers. */
static double noise(double deviation)
{
  static unsigned seed = 1;
  double sum = -6.0;
  for (int k = 0; k < 12; k++) {
    seed = 1664525u * seed + 1013904223u;
    sum += (double)(seed >> 8) / 16777216.0;
  }
  return deviation * sum;
}

/* x and P a period later: P = Phi P Phi^T + noise of the momenta. */
static int predict(const double u[model_INPUTS])
{
  static double Phi[N][N], Gamma[N][model_INPUTS], A[N][N];
  static model_work work;
  const int status = model_step_jacobian(x, Phi[0], Gamma[0], &work, u, period);
  for (int i = 0; i < N; i++) {
    for (int j = 0; j < N; j++) {
      A[i][j] = 0.0;
      for (int k = 0; k < N; k++) {
        A[i][j] += Phi[i][k] * P[k][j];
      }
    }
  }
  for (int i = 0; i < N; i++) {
    for (int j = 0; j < N; j++) {
      P[i][j] = i == j && i >= 10 ? 1e-10 : 0.0; /* [(N m s)^2] L and below, by torques that are not known */
      for (int k = 0; k < N; k++) {
        P[i][j] += A[i][k] * Phi[j][k];
      }
    }
  }
  return status;
}

/* One number has been measured: `miss` more than expected, h its derivative by the state. */
static void update(const double h[N], double miss, double deviation)
{
  double Ph[N], size = deviation * deviation;
  for (int i = 0; i < N; i++) {
    Ph[i] = 0.0;
    for (int j = 0; j < N; j++) {
      Ph[i] += P[i][j] * h[j];
    }
    size += h[i] * Ph[i];
  }
  for (int i = 0; i < N; i++) {
    x[i] += Ph[i] / size * miss;
    for (int j = 0; j < N; j++) {
      P[i][j] -= Ph[i] * Ph[j] / size;
    }
  }
}

/* The gyro: angular rate of the hub. */
static int update_gyro(const double rate[3], const double u[model_INPUTS])
{
  double y[16], J[model_sense_O_entries], h[3][N] = {{0.0}};
  const int status = model_sense_O_jacobian(y, J, x, u);
  for (int e = 0; e < model_sense_O_entries; e++) {
    const int row = model_sense_O_at[e][0], column = model_sense_O_at[e][1];
    if (row < 3 && column < N) {
      h[row][column] = J[e];
    }
  }
  for (int i = 0; i < 3; i++) {
    double expected = y[i];
    update(h[i], rate[i] - expected, gyro_noise);
  }
  return status;
}

/* The star tracker: rotation from the estimate to what is seen, 2 times the vector part of conj(estimate) seen. */
static void update_stars(const double seen[4])
{
  for (int i = 0; i < 3; i++) {
    const double w = x[QUAT], a = x[QUAT + 1], b = x[QUAT + 2], c = x[QUAT + 3];
    const double row[3][4] = {{-a, w, c, -b}, {-b, -c, w, a}, {-c, b, -a, w}};
    double h[N] = {0.0}, miss = 0.0, size = 0.0;
    for (int k = 0; k < 4; k++) {
      h[QUAT + k] = 2.0 * row[i][k];
      miss += 2.0 * row[i][k] * seen[k];
    }
    update(h, miss, star_noise);
    for (int k = 0; k < 4; k++) {
      size += x[QUAT + k] * x[QUAT + k];
    }
    for (int k = 0; k < 4; k++) {
      x[QUAT + k] /= sqrt(size);
    }
  }
}

/* A push on the tip bends the wing before the filter begins. */
static fb_status push(fb_state *truth)
{
  static fb_rk4_work work;
  fb_input input = {.n_load = 1, .load = {{.node = 1, .axes = FB_AXES_BODY, .force = {0, 1.0, 2.0}}}}; // [N]
  fb_status status = fb_state_init(&satellite, truth);
  for (int k = 0; k < 1000 && status == FB_OK; k++) {
    status = fb_rk4_step(&satellite, truth, &work, &input, &input, &input, 1e-3);
  }
  return status;
}

/* Tip of the wing against the undeformed body [m]. */
static double tip(const fb_real *q, int axis)
{
  double sum = 0.0;
  for (int a = 0; a < satellite.n; a++) {
    sum += satellite.node[1].psi[3 * a + axis] * q[a];
  }
  return sum;
}

int main(void)
{
  static fb_state truth;
  static fb_rk4_work work;
  fb_status status = push(&truth);
  double worst_tip = 0.0, worst_turn = 0.0, ratio = 0.0;
  int failed = 0, judged = 0;

  /* the filter knows position and velocity; attitude to 10 mrad, rate and modes not at all */
  for (int i = 0; i < 3; i++) {
    x[i] = truth.rho[i];
    x[7 + i] = truth.u[i];
  }
  x[QUAT] = 1.0;
  for (int i = 0; i < N; i++) {
    const double deviation = i < 3 || (i >= 7 && i < 10) ? 0.0 : i < 7 ? 0.01 : i < Q ? 10.0 : i < Q + 6 ? 0.1 : 1.0;
    P[i][i] = deviation * deviation;
  }

  printf("    t [s]  attitude [mrad]   tip y, z [mm]         filter          error   expected\n");
  for (int k = 0; k <= 3000 && status == FB_OK && !failed; k++) {
    const double t = k * period,
                 torque = t >= 10.0 && t < 12.0 ? 5.0 : 0.0; /* [N m] the thrusters, known to the filter */
    const fb_input input = {.n_load = 1, .load = {{.axes = FB_AXES_BODY, .torque = {0, torque, 0}}}};
    const double u[model_INPUTS] = {0, 0, 0, 0, torque, 0};
    fb_motion motion;
    double rate[3], error[2], expected = 0.0, turn;

    /* sensors see the truth */
    status = fb_body_motion_eval(&satellite, &motion, &truth, &input);
    for (int i = 0; i < 3; i++) {
      rate[i] = motion.w[i] + noise(gyro_noise);
    }
    failed |= update_gyro(rate, u);
    if (k % 20 == 0) {
      const double half[3] = {0.5 * noise(star_noise), 0.5 * noise(star_noise), 0.5 * noise(star_noise)};
      const fb_real small[4] = {1.0, half[0], half[1], half[2]};
      fb_real seen[4];
      fb_quat_mul(seen, truth.quat, small);
      update_stars(seen);
    }

    /* errors, and what the filter expects of the tip's */
    error[0] = tip(x + Q, 1) - tip(truth.q, 1);
    error[1] = tip(x + Q, 2) - tip(truth.q, 2);
    for (int a = 0; a < satellite.n; a++) {
      for (int b = 0; b < satellite.n; b++) {
        expected += (satellite.node[1].psi[3 * a + 1] * satellite.node[1].psi[3 * b + 1] +
                     satellite.node[1].psi[3 * a + 2] * satellite.node[1].psi[3 * b + 2]) *
                    P[Q + a][Q + b];
      }
    }
    turn =
        2.0 *
        sqrt(fabs(1.0 -
                  pow(x[3] * truth.quat[0] + x[4] * truth.quat[1] + x[5] * truth.quat[2] + x[6] * truth.quat[3], 2.0)));
    if (t > 20.0) {
      worst_tip = fmax(worst_tip, sqrt(error[0] * error[0] + error[1] * error[1]));
      worst_turn = fmax(worst_turn, turn);
      ratio += (error[0] * error[0] + error[1] * error[1]) / expected;
      judged++;
    }
    if (k % 300 == 0) {
      printf("%9.1f %16.3f %9.2f %7.2f %9.2f %7.2f %9.3f %10.3f\n", t, 1e3 * turn, 1e3 * tip(truth.q, 1),
             1e3 * tip(truth.q, 2), 1e3 * tip(x + Q, 1), 1e3 * tip(x + Q, 2),
             1e3 * sqrt(error[0] * error[0] + error[1] * error[1]), 1e3 * sqrt(expected));
    }

    /* a period later: the craft by ten steps of the library, the filter by one of its own */
    for (int i = 0; i < 10 && status == FB_OK; i++) {
      status = fb_rk4_step(&satellite, &truth, &work, &input, &input, &input, 0.1 * period);
    }
    failed |= predict(u);
  }
  ratio /= judged > 0 ? judged : 1;
  failed |= status != FB_OK || !(worst_tip < 1e-3) || !(worst_turn < 1e-4) || !(ratio > 0.1 && ratio < 4.0);
  printf("after 20 s the tip is known to %.2f mm (bound 1), the attitude to %.3f mrad (bound 0.1); square of the tip's "
         "error by\n"
         "what the filter expects %.2f (bound 0.1 to 4)\n",
         1e3 * worst_tip, 1e3 * worst_turn, ratio);
  return failed || fflush(stdout) != 0;
}
