/* hinged.h - a rotor of rigid blades with flap and lag hinges at an offset, in closed form: frequencies of the hinges,
   flap, thrust and hub moments in forward flight, torsion of a uniform blade. README.md derives them by the numbers in
   brackets. Include flexbeam.h, check.h, ../common/rigid_rotor.h and airloads.h before. */
#ifndef HINGED_H
#define HINGED_H

typedef struct flight {          /* means over a revolution; pitch = mean + cosine cos psi + sine sin psi */
  double pitch[3], flap[3], lag; /* [rad] mean, cosine, sine; [rad] of the lag hinges, forward */
  double thrust, hub_moment[2];  /* [N]; [N m] on the shaft, about x (downwind) and y (psi = 90 deg) */
} flight;

/* [A12] Frequencies of the hinges by the shaft's, and growth rate [1/s] of the lag under its damper. */
typedef struct hinge_numbers {
  double flap, lag, lag_growth;
} hinge_numbers;

static inline hinge_numbers hinge_frequencies(const rotor_data *d)
{
  const double L = d->radius - d->offset, S = d->mass * L * L / 2;
  const double I_lag = d->mass * L * (L * L / 3 + d->chord * d->chord / 12);
  return (hinge_numbers){closed_form(d).nu, sqrt(d->offset * S / I_lag), -d->lag_damper / (2 * I_lag)};
}

/* [A13] First torsion of a uniform blade that turns, sin(pi x/2 L) from its bearing, whose line is the quarter chord:
   frequency [rad/s] and growth rate [1/s] by the damping of [A3] in hover. */
static inline void torsion_numbers(double *frequency, double *growth, const rotor_data *d, double GJ)
{
  const double L = d->radius - d->offset, b = 0.5 * d->chord, inertia = d->mass * d->chord * d->chord / 12;
  const double wave = 0.5 * pi / L, place = 2 * (0.25 + 1 / (pi * pi)) * L + d->offset; /* [m] mean by the square */
  *growth = -0.5 * pi * d->density * b * b * b * d->spin * place / inertia;
  *frequency = sqrt(GJ / inertia * wave * wave + d->spin * d->spin - *growth * *growth);
}

/* [A11] Of the pitch and the flap, in the inflow lambda of the speed of the tips: what the flap moments lack, by I W^2:
   mean, cosine, sine. Writes thrust and hub moments. Gauss's rule along the blade and the sum around are exact. */
static inline void hinged_balance(double miss[3], flight *f, const rotor_data *d, double advance, double lambda)
{
  enum { AROUND = 8 };
  const double place[3] = {-0.774596669241483377, 0, 0.774596669241483377}, part[3] = {5 / 18.0, 8 / 18.0, 5 / 18.0};
  const double R = d->radius, W = d->spin, e = d->offset / R, L = R - d->offset, S = d->mass * L * L / 2;
  const double load = 0.5 * d->density * d->lift_slope * d->chord * W * W * R * R * L, roll = 0.75 * d->chord / R;
  const blade_numbers blade = closed_form(d);
  const double *const p = f->pitch, *const b = f->flap;
  miss[0] = miss[1] = miss[2] = f->thrust = f->hub_moment[0] = f->hub_moment[1] = 0;
  for (int k = 0; k < AROUND; k++) {
    const double c = cos(2 * pi * k / AROUND), s = sin(2 * pi * k / AROUND);
    const double theta = p[0] + p[1] * c + p[2] * s, theta_rate = p[2] * c - p[1] * s;
    const double tilt = b[1] * c + b[2] * s, beta = b[0] + tilt, beta_rate = b[2] * c - b[1] * s;
    double lift = 0, moment = 0, around = 2 * blade.I * W * W * beta * beta_rate, lack, shear;
    for (int i = 0; i < 3; i++) {
      const double x = e + 0.5 * (1 - e) * (1 + place[i]), u_T = x + advance * s;
      const double u_P = lambda + (x - e) * beta_rate + advance * c * beta, turn = roll * (beta + theta_rate);
      const double force = part[i] * load * (u_T * theta - u_P + turn);
      lift += force * u_T;
      moment += force * u_T * (x - e) * R;
      around -= (force * u_P + part[i] * load * d->drag / d->lift_slope * u_T * u_T) * (x - e) * R;
    }
    lack = (moment / (blade.I * W * W) - blade.nu * blade.nu * beta + tilt) / AROUND;
    shear = (lift + S * W * W * tilt) / AROUND; /* on the hinge: S (W^2 tilt) is -S beta'' */
    miss[0] += lack;
    miss[1] += 2 * lack * c;
    miss[2] += 2 * lack * s;
    f->thrust += BLADES * lift / AROUND;
    f->hub_moment[0] += BLADES * (d->offset * shear * s - around * beta * c / AROUND);
    f->hub_moment[1] -= BLADES * (d->offset * shear * c + around * beta * s / AROUND);
  }
}

/* The flap of given pitch, or the pitch and coning of given thrust and tilt: as all is linear, from its value at zero
   and its change with each unknown. */
static inline flight hinged_solve(const rotor_data *d, double advance, double lambda, flight given, int trim)
{
  double *const unknown[2][4] = {{&given.flap[0], &given.flap[1], &given.flap[2], NULL},
                                 {&given.flap[0], &given.pitch[0], &given.pitch[1], &given.pitch[2]}};
  const int n = trim ? 4 : 3;
  const double thrust = given.thrust;
  fb_real A[16], b[4], x[4], scale[4];
  double miss[4];
  int perm[4];
  for (int j = 0; j < n; j++) {
    *unknown[trim][j] = 0;
  }
  for (int j = -1; j < n; j++) {
    if (j >= 0) {
      *unknown[trim][j] = 1;
    }
    hinged_balance(miss, &given, d, advance, lambda);
    miss[3] = given.thrust / thrust - 1;
    for (int i = 0; i < n; i++) {
      if (j < 0) {
        b[i] = -(fb_real)miss[i];
      } else {
        A[i * n + j] = (fb_real)miss[i] + b[i];
      }
    }
    if (j >= 0) {
      *unknown[trim][j] = 0;
    }
  }
  need(fb_lu_factor(A, perm, scale, n), "closed form");
  fb_lu_solve(x, A, perm, b, n);
  for (int j = 0; j < n; j++) {
    *unknown[trim][j] = (double)x[j];
  }
  hinged_balance(miss, &given, d, advance, lambda);
  return given;
}
#endif
