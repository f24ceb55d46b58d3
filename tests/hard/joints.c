/* joints.c - systems: latches that close and open in motion, joints by way of massless bodies, a loop through positions
   where its constraints depend on each other. */
#include "hard.h"

static fb_system mechanism;
static fb_system_desc desc;
static fb_system_work work;
static fb_system_motion motion;
static fb_system_state state;
static fb_system_input input;
static fb_link_motion start[FB_MAX_BODIES];
static fb_body model[3];

static void fresh(void)
{
  memset(&desc, 0, sizeof desc);
  memset(&input, 0, sizeof input);
  memset(start, 0, sizeof start);
}

/* A rigid bar along x, node 1 at its end; without mass: nothing but that node. */
static void bar(fb_body *body, double mass, double length, double gravity)
{
  static fb_body_work body_work;
  const double J = mass * length * length / 12.0;
  const fb_real center[3] = {(fb_real)(0.5 * length), 0, 0}, end[3] = {(fb_real)length, 0, 0};
  const fb_real inertia[6] = {(fb_real)(0.01 * J), (fb_real)J, (fb_real)J, 0, 0, 0};
  fb_body_desc level;
  int node;
  memset(&level, 0, sizeof level);
  level.base = FB_BASE_PRESCRIBED;
  level.effects = FB_EFFECT_GRAVITY;
  level.gravity[0] = (fb_real)gravity;
  hard_must(fb_shape_init(&hard_shape, 0), "shape");
  if (mass > 0.0) {
    hard_must(fb_shape_add_rigid(&hard_shape, (fb_real)mass, center, inertia), "bar");
  }
  hard_must(fb_shape_add_node(&hard_shape, &node, end, NULL, NULL), "node");
  hard_must(fb_body_init(body, &body_work, &hard_shape, &level), "bar");
}

static void hang(int k, int which, fb_joint_kind kind, int parent, int node)
{
  desc.n_body = k + 1;
  desc.model[k] = which;
  desc.joint[k].kind = kind;
  desc.joint[k].parent = parent;
  desc.joint[k].parent_node = node;
}

static void launch(void)
{
  hard_must(fb_system_init(&mechanism, &work, model, &desc, 3), "system");
  hard_must(fb_system_state_init(&mechanism, model, &state, &work, start, &input), "system's state");
}

static void evaluate(void)
{
  hard_must(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, &input), "motion");
}

static void end_of(double x[3], int body)
{
  fb_node_motion node;
  hard_must(fb_body_node_motion_eval(&model[mechanism.model[body]], &node, &motion.pose[body], &motion.motion[body], 1),
            "node");
  for (int i = 0; i < 3; i++) {
    x[i] = (double)node.position[i];
  }
}

static fb_status step(double dt)
{
  return fb_system_rk4_step(&mechanism, model, &state, &work, &input, &input, &input, (fb_real)dt);
}

/* ---- latches */

/* What m roundings, of half an eps each and of either sign, add up to. */
static double rounding(double m)
{
  return 0.5 * HARD_EPSILON * sqrt(m);
}

enum { LINKS = 4, STEPS_PER_LATCH = 20, MOST = 16 }; /* speeds */

/* A free body with three flexible links one after the other; model 1 the hub, model 0 the link. */
static void chain(void)
{
  static const fb_joint_kind kind[LINKS] = {FB_JOINT_FREE, FB_JOINT_UNIVERSAL, FB_JOINT_REVOLUTE, FB_JOINT_REVOLUTE};
  static hard_craft craft;
  fb_momentum momentum;
  fb_real mass = FB_R(0.0);
  fresh();
  hard_craft_init(&craft, 1.0, 0.8, 30.0);
  craft.keep.count[FB_KIND_BEND_Y] = craft.keep.count[FB_KIND_BEND_Z] = 1;
  craft.hub_mass = 0.5;
  craft.hub_inertia[0] = craft.hub_inertia[1] = craft.hub_inertia[2] = 0.02;
  craft.level.base = FB_BASE_PRESCRIBED;
  hard_craft_build(&model[0], &craft);
  bar(&model[1], 5.0, 0.5, 0.0);
  for (int k = 0; k < LINKS; k++) {
    hang(k, k == 0, kind[k], k - 1, 1); /* FB_GROUND is -1 */
    start[k].value[0] = k > 0 ? FB_R(0.5) : 0;
    start[k].speed[0] = k > 0 ? FB_R(0.4) : 0;
    mass += model[k == 0].mass;
  }
  start[0].speed[4] = FB_R(0.3);
  launch();
  hard_must(fb_system_momentum_eval(&mechanism, model, &work, &momentum, &state, &input), "momentum");
  for (int i = 0; i < 3; i++) { /* the mass center rests, positions stay small */
    start[0].speed[i] = -momentum.linear[i] / mass;
  }
  launch();
}

static double energy_of(void)
{
  fb_energy energy;
  hard_must(fb_system_energy_eval(&mechanism, model, &work, &energy, &state, &input), "energy");
  return (double)energy.kinetic + (double)energy.strain;
}

/* The chain as it is, into start. */
static void take(void)
{
  evaluate();
  for (int k = 0; k < LINKS; k++) {
    memcpy(start[k].value, k == 0 ? state.link[k].x : motion.joint[k].value, sizeof start[k].value);
    memcpy(start[k].quat, state.link[k].quat, sizeof start[k].quat);
    memcpy(start[k].speed, motion.joint[k].speed, sizeof start[k].speed);
    memcpy(start[k].q, state.link[k].q, sizeof start[k].q);
    memcpy(start[k].q_dot, motion.motion[k].q_dot, sizeof start[k].q_dot);
  }
}

/* What one would write: the rate of the joint becomes zero, all else stays. */
static void stop(int joint)
{
  take();
  start[joint].speed[0] = 0;
  hard_must(fb_system_state_init(&mechanism, model, &state, &work, start, &input), "system's state");
}

/* Speeds of the chain in a row: those of the joint and of the modes, link by link. The first of link k. */
static int speed_of(int k)
{
  int n = 0;
  for (int j = 0; j < k; j++) {
    n += mechanism.joint[j].n_axis + model[mechanism.model[j]].n;
  }
  return n;
}

/* Kinetic energy where the chain is, at speeds that are all zero but those i and j, which are 1. */
static double kinetic_of(int i, int j)
{
  static fb_system_state moved;
  fb_energy energy;
  for (int k = 0, at = 0; k < LINKS; k++) {
    for (int a = 0; a < mechanism.joint[k].n_axis; a++, at++) {
      start[k].speed[a] = at == i || at == j ? FB_R(1.0) : FB_R(0.0);
    }
    for (int a = 0; a < model[mechanism.model[k]].n; a++, at++) {
      start[k].q_dot[a] = at == i || at == j ? FB_R(1.0) : FB_R(0.0);
    }
  }
  hard_must(fb_system_state_init(&mechanism, model, &moved, &work, start, &input), "system's state");
  hard_must(fb_system_energy_eval(&mechanism, model, &work, &energy, &moved, &input), "energy");
  return (double)energy.kinetic;
}

/* The mass that the speed s meets where all other momenta are kept, 1 / (M^-1)_ss: M by the energies of unit speeds,
   all but s eliminated from it. *growth: M_ss over it, by which errors of M grow. */
static double mass_met(int s, double *growth)
{
  static double M[MOST][MOST];
  const int n = speed_of(LINKS);
  take();
  for (int i = 0; i < n; i++) {
    for (int j = 0; j <= i; j++) {
      M[i][j] = kinetic_of(i, j); /* i = j: M_ii / 2, else M_ij more than what the two have by themselves */
    }
  }
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < i; j++) {
      M[i][j] -= M[i][i] + M[j][j];
      M[j][i] = M[i][j];
    }
  }
  for (int i = 0; i < n; i++) {
    M[i][i] *= 2.0;
  }
  *growth = M[s][s];
  for (int k = 0; k < n; k++) {
    for (int i = 0; i < n && k != s; i++) {
      const double factor = i == k ? 0.0 : M[i][k] / M[k][k];
      for (int j = 0; j < n; j++) {
        M[i][j] -= factor * M[k][j];
      }
    }
  }
  *growth /= M[s][s];
  return M[s][s];
}

/* What latches did at worst, of what there was: momentum lost or energy won, the size of what the momentum is the sum
   of, energy lost beside the closed form u^2 / (2 (M^-1)_ss) of a plastic impact at speed u, growth of errors in
   that. */
typedef struct worn {
  double lost, size, apart, growth;
} worn;

/* Sum of what the bodies' angular momenta are at most, m |x| |v| and |J w|; link 0 is rigid, the others about as
   heavy. */
static double parts(void)
{
  double sum = 0.0;
  evaluate();
  for (int k = 0; k < LINKS; k++) {
    const fb_body *b = &model[mechanism.model[k]];
    const fb_real *x = motion.pose[k].rho, *v = motion.motion[k].v, *w = motion.motion[k].w;
    const double reach = 1.0; /* [m] length of a link, twice that of the hub */
    sum += (double)b->mass * (hard_length(x) + reach) * (hard_length(v) + reach * hard_length(w));
  }
  return sum;
}

static void latch_once(worn *all, int joint, int naive, int compared)
{
  double before = energy_of(), u = 0.0, growth = 0.0, mass = 0.0;
  if (compared) {
    mass = mass_met(speed_of(joint), &growth);
    u = (double)motion.joint[joint].speed[0];
  }
  if (naive) {
    stop(joint);
  } else {
    hard_must(fb_system_axis_set(&mechanism, model, &state, &work, joint, 0, FB_AXIS_LOCKED, &input), "latch");
  }
  all->lost = fmax(all->lost, energy_of() / before - 1.0);
  if (compared) {
    all->apart = fmax(all->apart, fabs(before - energy_of() - 0.5 * mass * u * u) / before);
    all->growth = fmax(all->growth, growth);
  }
}

static worn latch(int latches, int naive)
{
  fb_momentum first, now;
  worn all = {0.0, 0.0, 0.0, 0.0};
  chain();
  hard_must(fb_system_momentum_eval(&mechanism, model, &work, &first, &state, &input), "momentum");
  for (int k = 0; k < latches; k++) {
    const int joint = 1 + k % (LINKS - 1);
    latch_once(&all, joint, naive, naive || k % 100 < LINKS - 1);
    hard_must(fb_system_momentum_eval(&mechanism, model, &work, &now, &state, &input), "momentum");
    all.lost = fmax(all.lost, hard_difference(now.angular, first.angular, 3) / hard_length(first.angular));
    all.size = fmax(all.size, parts() / hard_length(first.angular));
    for (int i = 0; i < STEPS_PER_LATCH; i++) {
      for (int j = 1; j < LINKS; j++) { /* motors within keep it moving */
        input.drive[j].torque[0] = (fb_real)(0.3 * sin(0.001 * (k * STEPS_PER_LATCH + i) * j));
      }
      hard_must(step(0.001), "step");
    }
    hard_must(fb_system_axis_set(&mechanism, model, &state, &work, joint, 0, FB_AXIS_FREE, &input), "latch");
    hard_progress(k, latches);
  }
  return all;
}

/* Bounds by what rounds: one for each of the n speeds that are solved for and multiplied by. The momentum: in each of
   LINKS parts, of the size of those; the number of latches is not in it, they leave momenta as they are. The energy
   lost, of what there was: u^2 / (2 (M^-1)_ss) is no more than that, the errors of M grow in it by M_ss (M^-1)_ss. */
void hard_latches(int brief)
{
  const int latches = brief ? 1000 : 30000;
  worn ours, naive;
  hard_row row = {.name = "latches",
                  .what = "joints of a flexible chain in free flight latch in motion and open again",
                  .degree = "latchings",
                  .measure = "momentum lost or energy won by a latch, of what there was",
                  .naive = "the joint's rate set to zero, a hundred times"};
  row.hard = latches;
  row.steps = latches * STEPS_PER_LATCH;
  row.time = row.steps * 0.001;
  ours = latch(latches, 0);
  naive = latch(100, 1);
  row.bound = rounding(speed_of(LINKS) * LINKS) * ours.size;
  row.figure = ours.lost;
  row.naive_figure = naive.lost;
  hard_report(&row);
  row.name = "latches energy";
  row.measure = "energy lost against a plastic impact's in closed form, of what there was";
  row.bound = rounding(speed_of(LINKS)) * ours.growth;
  row.figure = ours.apart;
  row.naive_figure = naive.apart;
  hard_report(&row);
}

/* ---- joints by way of massless bodies */

/* A pendulum of 1 m that hangs along x, on a spherical joint or on three hinges z, y, x with bodies without mass
   between. */
static void pendulum(int hinges)
{
  static const fb_real speed[3] = {FB_R(0.5), FB_R(0.7), FB_R(1.5)}; /* [rad/s] about x, y, z */
  static const double turn[3][3] = {
      {0, 0, 0}, {-HARD_PI / 2, 0, 0}, {0, HARD_PI / 2, 0}}; /* z of the joint along z, y, x */
  fresh();
  bar(&model[0], 1.0, 1.0, 9.81);
  bar(&model[1], 0.0, 0.0, 0.0);
  bar(&model[2], 0.0, 0.0, 0.0);
  for (int k = 0; k < 3; k++) {
    const fb_real phi[3] = {(fb_real)turn[k][0], (fb_real)turn[k][1], (fb_real)turn[k][2]};
    if (hinges) {
      hang(k, k == 2 ? 0 : k + 1, FB_JOINT_REVOLUTE, k - 1, k > 0);
      fb_quat_from_rotvec(desc.joint[k].attitude, phi);
      fb_quat_from_rotvec(desc.joint[k].child_attitude, phi);
      start[k].speed[0] = speed[2 - k];
    } else {
      start[0].speed[k] = speed[k];
    }
  }
  if (!hinges) {
    hang(0, 0, FB_JOINT_SPHERICAL, FB_GROUND, 0);
  }
}

void hard_massless(int brief)
{
  enum { SAMPLES = 50 };
  static double x[SAMPLES][3];
  const double dt = 0.001;
  const int steps = brief ? 200 : 4000; /* between samples */
  hard_row row = {.name = "massless",
                  .what = "a swinging, spinning pendulum on three hinges with massless bodies between them",
                  .degree = "bodies without mass",
                  .measure = "its end against that on one spherical joint [m]",
                  .bound = HARD_TOL(1e-8, 1e-2),
                  .naive = "each body by its own mass matrix, joints as loops of free bodies"};
  row.hard = 2.0;
  row.steps = SAMPLES * steps;
  row.time = row.steps * dt;
  row.periods = row.time * sqrt(1.5 * 9.81) / (2.0 * HARD_PI);
  for (int hinges = 0; hinges < 2; hinges++) {
    pendulum(hinges);
    launch();
    for (int k = 0; k < SAMPLES; k++) {
      double now[3];
      for (int i = 0; i < steps; i++) {
        hard_must(step(dt), "step");
        hard_progress(hinges * SAMPLES + k, 2 * SAMPLES);
      }
      evaluate();
      end_of(now, hinges ? 2 : 0);
      for (int i = 0; i < 3 && hinges; i++) {
        row.figure = fmax(row.figure, fabs(now[i] - x[k][i]));
      }
      memcpy(x[k], now, sizeof now);
    }
  }
  pendulum(1);
  desc.n_loop = 3;
  for (int k = 0; k < 3; k++) {
    desc.loop[k] = desc.joint[k];
    desc.loop[k].child = k;
    memset(&desc.joint[k], 0, sizeof desc.joint[k]);
  }
  row.naive_figure = fb_system_init(&mechanism, &work, model, &desc, 3) == FB_ERR_SINGULAR ? HUGE_VAL : 0.0;
  hard_report(&row);
}

/* ---- a parallelogram through its flat positions */

static const double side[3] = {0.5, 1.0, 0.5}; /* [m] crank, coupler, rocker; 1 kg/m */
static const double ground = 0.3,
                    gravity = 0.3; /* [rad] direction of the fourth side, as long as the coupler; [m/s^2] along x */
enum { CRANK, COUPLER, ROCKER, ANGLES };

/* What one would write: absolute angles x[0..2] and rates x[3..5], the loop's two constraints as accelerations, one LU
   of mass and constraints. 0: it is singular. */
static int loop_rates(double rate[6], const double x[6])
{
  const double *l = side, *w = x + ANGLES, couple = 0.5 * l[COUPLER] * l[CRANK] * l[COUPLER];
  const double sign[3] = {1.0, 1.0, -1.0}, s = sin(x[CRANK] - x[COUPLER]);
  fb_real A[25] = {0}, b[5] = {0}, y[5], scale[5];
  int perm[5];
  for (int k = 0; k < ANGLES; k++) {
    A[6 * k] = (fb_real)(l[k] * l[k] * l[k] / 3.0 + (k == CRANK ? l[COUPLER] * l[CRANK] * l[CRANK] : 0.0));
    A[5 * k + 3] = A[15 + k] = (fb_real)(-sign[k] * l[k] * sin(x[k]));
    A[5 * k + 4] = A[20 + k] = (fb_real)(sign[k] * l[k] * cos(x[k]));
    b[3] += (fb_real)(sign[k] * l[k] * cos(x[k]) * w[k] * w[k]);
    b[4] += (fb_real)(sign[k] * l[k] * sin(x[k]) * w[k] * w[k]);
  }
  for (int k = 0; k < ANGLES; k++) {
    b[k] = (fb_real)(-gravity * sin(x[k]) * (0.5 * l[k] * l[k] + (k == CRANK ? l[COUPLER] * l[CRANK] : 0.0)));
  }
  A[1] = A[5] = (fb_real)(couple * cos(x[CRANK] - x[COUPLER]));
  b[CRANK] += (fb_real)(-couple * s * w[COUPLER] * w[COUPLER]);
  b[COUPLER] += (fb_real)(couple * s * w[CRANK] * w[CRANK]);
  if (fb_lu_factor(A, perm, scale, 5) != FB_OK) {
    return 0;
  }
  fb_lu_solve(y, A, perm, b, 5);
  for (int k = 0; k < ANGLES; k++) {
    rate[k] = w[k];
    rate[ANGLES + k] = (double)y[k];
  }
  return 1;
}

/* Its largest gap [m]. */
static double naive_loop(double begin, double spin, double dt, int steps)
{
  static const double part[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
  double x[6] = {begin + ground, ground, begin + ground, spin, 0.0, spin}, gap = 0.0;
  for (int step_number = 0; step_number < steps; step_number++) {
    double rate[6] = {0}, sum[6] = {0}, at[6];
    for (int stage = 0; stage < 4; stage++) {
      for (int i = 0; i < 6; i++) {
        at[i] = x[i] + part[stage] * dt * rate[i];
      }
      if (!loop_rates(rate, at)) {
        return HUGE_VAL;
      }
      for (int i = 0; i < 6; i++) {
        sum[i] += weight[stage] * rate[i];
      }
    }
    for (int i = 0; i < 6; i++) {
      x[i] += dt * sum[i];
    }
    gap = fmax(gap, hypot(side[0] * cos(x[0]) + side[1] * cos(x[1]) - side[2] * cos(x[2]) - side[1] * cos(ground),
                          side[0] * sin(x[0]) + side[1] * sin(x[1]) - side[2] * sin(x[2]) - side[1] * sin(ground)));
  }
  return gap;
}

/* The bound: angles of a hundred turns round by half an eps of them, each moves the ends by its arms: 2.1e-13, in
   single precision 1.1e-4. In double precision that holds but in the flat positions (7e-14), where the one step that
   closes the loop leaves more, 5e-13, of what rk4 tore open: the 1e-12 is from experience, not derived. */
void hard_loop(int brief)
{
  const double spin = 2.0, dt = HARD_PI / HARD_TOL(2048, 512), begin = -100.37 * dt;
  const int steps = (brief ? 10 : 100) * (int)HARD_TOL(2048, 512);
  double a[3], b[3];
  hard_row row = {
      .name = "loop",
      .what = "a free parallelogram turns through its flat positions, where its constraints depend on each other",
      .degree = "flat positions passed",
      .measure = "gap of the loop [m]",
      .naive = "constraints as accelerations, one LU with the mass matrix"};
  fresh();
  for (int k = 0; k < ANGLES; k++) {
    bar(&model[k], side[k], side[k], gravity);
    hang(k, k, FB_JOINT_REVOLUTE, k == COUPLER ? CRANK : FB_GROUND, k == COUPLER);
    start[k].value[0] = (fb_real)(k == COUPLER ? -begin : begin + ground);
    start[k].speed[0] = (fb_real)(k == COUPLER ? -spin : spin);
  }
  desc.joint[ROCKER].position[0] = (fb_real)(side[COUPLER] * cos(ground));
  desc.joint[ROCKER].position[1] = (fb_real)(side[COUPLER] * sin(ground));
  desc.n_loop = 1;
  desc.loop[0].kind = FB_JOINT_REVOLUTE;
  desc.loop[0].parent = COUPLER;
  desc.loop[0].child = ROCKER;
  desc.loop[0].parent_node = desc.loop[0].child_node = 1;
  launch();
  for (int k = 0; k < steps; k++) {
    hard_must(step(dt), "step");
    evaluate();
    end_of(a, COUPLER);
    end_of(b, ROCKER);
    row.figure = fmax(row.figure, hypot(a[0] - b[0], a[1] - b[1]));
    hard_progress(k, steps);
  }
  row.bound = HARD_TOL(1e-12, rounding(1) * spin * dt * steps * (side[CRANK] + 2.0 * side[COUPLER] + side[ROCKER]));
  row.hard = floor((spin * dt * steps + begin) / HARD_PI) + 1.0;
  row.steps = steps;
  row.time = steps * dt;
  row.periods = row.time * spin / (2.0 * HARD_PI);
  row.naive_figure = naive_loop(begin, spin, dt, steps);
  hard_report(&row);
}
