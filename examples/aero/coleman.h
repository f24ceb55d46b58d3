/* coleman.h - ground resonance of a rotor with lag hinges on a support that is alike in all directions of the plane of
   rotation: R. P. Coleman and A. M. Feingold, "Theory of self-excited mechanical oscillations of helicopter rotors with
   hinged blades", NACA report 1351, 1958. Include flexbeam.h and check.h before. */
#ifndef COLEMAN_H
#define COLEMAN_H

typedef struct coleman_rotor {
  double blades, offset, length, blade_mass; /* at least three; [m] of the hinges, [m] of a uniform blade, [kg] */
  double mass, frequency;                    /* [kg] of hub and support, [rad/s] of the support with the rotor */
  double lag_damper, damping;                /* [N m s/rad] of each hinge, [N s/m] of the support */
} coleman_rotor;

static inline double coleman_mass(const coleman_rotor *o)
{
  return o->mass + o->blades * o->blade_mass;
}

/* [A10] Growth rate [1/s]: largest real part of D with det = 0 for hub Z and lag S as complex numbers in the rotating
   frame, p = D + i W:
     (M p^2 + c p + K) Z + i N m r p^2 S = 0,   I (D^2 + d D/I + W^2 m e r/I) S - i/2 m r p^2 Z = 0
   as a first-order system of (Z, S, Z', S'), real and imaginary parts. */
static inline double coleman_growth(const coleman_rotor *o, double W, int damped)
{
  const double N = o->blades, m = o->blade_mass, r = o->length / 2, I_h = m * o->length * o->length / 3;
  const double M = coleman_mass(o), K = M * o->frequency * o->frequency;
  const double c = damped ? o->damping : 0, d = damped ? o->lag_damper : 0;
  /* rows: hub, lag; by Z and S; real and imaginary part of the factor of D^2, D, 1 */
  const double mass[2][2][2] = {{{M, 0}, {0, N * m * r}}, {{0, -0.5 * m * r}, {I_h, 0}}};
  const double speed[2][2][2] = {{{c, 2 * W * M}, {-2 * W * N * m * r, 0}}, {{W * m * r, 0}, {d, 0}}};
  const double place[2][2][2] = {{{K - W * W * M, W * c}, {0, -W * W * N * m * r}},
                                 {{0, 0.5 * W * W * m * r}, {W * W * m * o->offset * r, 0}}};
  fb_real G[16], B[4 * 8], A[64] = {0}, X[128], scratch[256], re[8], im[8], scale[4];
  int perm[4];
  double most = -1e300;
  for (int i = 0; i < 4; i++) { /* real 4 x 4 of complex 2 x 2: i, j real parts, then imaginary */
    for (int j = 0; j < 4; j++) {
      const int row = i % 2, column = j % 2, sign = i < 2 && j >= 2 ? -1 : 1, part = (i < 2) != (j < 2);
      G[4 * i + j] = (fb_real)(sign * mass[row][column][part]);
      B[8 * i + j] = (fb_real)(-sign * place[row][column][part]);
      B[8 * i + 4 + j] = (fb_real)(-sign * speed[row][column][part]);
    }
  }
  need(fb_lu_factor(G, perm, scale, 4), "mass matrix");
  for (int j = 0; j < 8; j++) {
    const fb_real b[4] = {B[j], B[8 + j], B[16 + j], B[24 + j]};
    fb_real x[4];
    fb_lu_solve(x, G, perm, b, 4);
    for (int i = 0; i < 4; i++) {
      A[8 * (4 + i) + j] = x[i];
      A[8 * i + 4 + i] = 1;
    }
  }
  need(fb_eig_general_solve(re, im, X, A, scratch, 8), "closed form");
  for (int i = 0; i < 8; i++) {
    most = fmax(most, (double)re[i]);
  }
  return most;
}
#endif
