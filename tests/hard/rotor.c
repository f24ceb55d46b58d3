/* rotor.c - a heavy disk that spins on a light shaft: its whirl speeds from the linear model. */
#include "hard.h"

enum { EI = 800 }; /* [N m^2] */
static const double length = 0.6, disk = 4.0, polar = 0.09, across = 0.05,
                    spin = 150.0; /* [m], [kg], [kg m^2], [rad/s] */

static fb_body model[2];
static fb_system mechanism;
static fb_system_analyse_work work;
static fb_system_state state;

/* A clamped shaft with `natural` modes each way and its deflections under loads at the tip, where the disk's bearing
   is. */
static void build(double shaft, int natural)
{
  static fb_body_work body_work;
  static fb_system_desc desc;
  static fb_link_motion start[FB_MAX_BODIES];
  const fb_real none[3] = {0}, turn[3] = {0, (fb_real)(0.5 * HARD_PI), 0};
  const fb_real J[6] = {(fb_real)polar, (fb_real)across, (fb_real)across, 0, 0, 0};
  hard_craft craft;
  hard_craft_init(&craft, length, shaft / length, EI);
  craft.beam.n_element = 6;
  craft.keep.count[FB_KIND_BEND_Y] = craft.keep.count[FB_KIND_BEND_Z] = natural;
  craft.keep.n_load = 4;
  for (int i = 0; i < 4; i++) {
    craft.keep.load[i].node = 6;
    craft.keep.load[i].axis = i < 2 ? 1 + i : 2 + i;
  }
  craft.level.base = FB_BASE_PRESCRIBED;
  hard_craft_build(&model[0], &craft);
  hard_must(fb_shape_init(&hard_shape, 0), "disk");
  hard_must(fb_shape_add_rigid(&hard_shape, (fb_real)disk, none, J), "disk");
  hard_must(fb_body_init(&model[1], &body_work, &hard_shape, &craft.level), "disk");
  memset(&desc, 0, sizeof desc);
  desc.n_body = 2;
  desc.model[1] = 1;
  desc.joint[0].kind = FB_JOINT_RIGID;
  desc.joint[0].parent = FB_GROUND;
  desc.joint[1].kind = FB_JOINT_REVOLUTE;
  desc.joint[1].parent_node = HARD_TIP;
  fb_quat_from_rotvec(desc.joint[1].attitude, turn);
  fb_quat_from_rotvec(desc.joint[1].child_attitude, turn);
  start[1].speed[0] = (fb_real)spin;
  hard_must(fb_system_init(&mechanism, &work.system, model, &desc, 2), "system");
  hard_must(fb_system_state_init(&mechanism, model, &state, &work.system, start, NULL), "system");
}

/* What vanishes at a whirl of the massless shaft, y + i z = exp(i l t) at the tip. */
static double equation(double l)
{
  const double k = EI / length, force = 12.0 * k / (length * length) - disk * l * l;
  return force * (4.0 * k - across * l * l + polar * spin * l) - 36.0 * k * k / (length * length);
}

/* Root k, 0 to 3: one on either side of +-sqrt(12 EI/(L^3 m)), where the equation is negative. */
static double whirl(int k)
{
  const double sign = k < 2 ? 1.0 : -1.0, middle = sign * sqrt(12.0 * EI / (length * length * length * disk));
  double inside = middle, outside = k % 2 ? 1e3 * middle : 0.0;
  for (int i = 0; i < 200; i++) {
    const double at = 0.5 * (inside + outside);
    *(equation(at) < 0.0 ? &inside : &outside) = at;
  }
  return fabs(inside);
}

/* Largest part by which a whirl, or a growth beside it, is off. */
static double miss(const fb_real *re, const fb_real *im, int n)
{
  double worst = 0.0;
  for (int k = 0; k < 4; k++) {
    const double want = whirl(k);
    double best = HUGE_VAL;
    for (int i = 0; i < n; i++) {
      best = fmin(best, hypot((double)re[i], fabs((double)im[i]) - want) / want);
    }
    worst = fmax(worst, best);
  }
  return worst;
}

/* Number j of the modes' coordinates, the disk's angle, the modes' momenta, the disk's. */
static fb_real *element(fb_system_state *of, int j)
{
  const int n = model[0].n;
  return j < n        ? &of->link[0].q[j]
         : j == n     ? &of->link[1].x[0]
         : j <= 2 * n ? &of->link[0].pi[j - n - 1]
                      : &of->link[1].p[0];
}

/* What one would write first: differences of the rates at momenta that stay, four points, a thousandth (single: a
   hundredth) of the body wide. */
static double naive(void)
{
  enum { MOST = 2 * FB_MAX_MODES + 2 };
  static const double at[4] = {-2, -1, 1, 2}, weight[4] = {1.0 / 12, -2.0 / 3, 2.0 / 3, -1.0 / 12};
  static fb_real A[MOST * MOST], X[2 * MOST * MOST], scratch[4 * MOST * MOST], re[MOST], im[MOST];
  const fb_body *const shaft = &model[0];
  const int n = shaft->n, size = 2 * n + 2;
  memset(A, 0, sizeof A);
  for (int j = 0; j < size; j++) {
    const int mode = j < n ? j : j - n - 1;
    const double part = HARD_TOL(1e-3, 1e-2);
    const double h = j == n || j == size - 1 ? part : part * (double)shaft->gyration / (double)shaft->reach[mode];
    for (int k = 0; k < 4; k++) {
      fb_system_state moved = state, rate;
      *element(&moved, j) += (fb_real)(at[k] * h);
      hard_must(fb_system_rates_eval(&mechanism, model, &work.system, &rate, &moved, NULL), "rates");
      for (int i = 0; i < size; i++) {
        A[i * size + j] += (fb_real)(weight[k] / h * (double)*element(&rate, i));
      }
    }
  }
  hard_must(fb_eig_general_solve(re, im, X, A, scratch, size), "eigenvalues");
  return miss(re, im, size);
}

void hard_rotor(int brief)
{
  static fb_spectrum spectrum;
  const double shaft = 0.006; /* [kg] */
  hard_row row = {.name = "rotor",
                  .what = "whirl speeds of a disk of 4 kg that spins at 150 rad/s on a shaft of 6 g",
                  .degree = "mass of the disk by the shaft's",
                  .measure =
                      "four whirl speeds, and their growth, against a massless shaft's in closed form, largest part",
                  .naive = "differences at constant momenta, of one width"};
  (void)brief;
  build(shaft, HARD_TOL(10, 1));
  hard_must(fb_system_spectrum_solve(&mechanism, model, &work, &spectrum, &state, NULL), "spectrum");
  row.hard = disk / shaft;
  row.bound = shaft / disk; /* what the mass of the shaft is worth at most */
  row.figure = miss(spectrum.re, spectrum.im, spectrum.n);
  row.naive_figure = naive();
  hard_report(&row);
}
