/* blades.c - the exact beam where it spins, flies and swings, against what its elements and steps might add. */
#include "hard.h"

static fb_exact_desc desc;
static fb_exact exact;
static fb_exact_state state;
static fb_exact_work work;
static fb_exact_input input;
static fb_exact_node node[FB_MAX_EXACT + 1];

static void begin(double length, int elements)
{
  memset(&desc, 0, sizeof desc);
  memset(&input, 0, sizeof input);
  desc.length = (fb_real)length;
  desc.n_element = elements;
}

static void start(void)
{
  hard_must(fb_exact_init(&exact, &desc), "exact beam");
  hard_must(fb_exact_state_init(&exact, &state, &work, &input), "state");
}

/* A uniform section by its diagonals. */
static void section(const double stiffness[6], const double inertia[6])
{
  desc.n_station = 1;
  for (int i = 0; i < 6; i++) {
    desc.station[0].stiffness[7 * i] = (fb_real)stiffness[i];
    desc.station[0].inertia[7 * i] = (fb_real)inertia[i];
  }
}

static fb_energy energy_of(void)
{
  fb_energy energy;
  hard_must(fb_exact_energy_eval(&exact, &energy, &state), "energy");
  return energy;
}

static double total(void)
{
  const fb_energy e = energy_of();
  return (double)e.kinetic + (double)e.strain + (double)e.gravity;
}

/* ---- growth of what has no loss and stands still as it turns */

/* Largest growth or decay of the slowest modes, of their frequency. */
static double growth(int modes)
{
  static fb_exact_spectrum spectrum;
  static fb_exact_spectrum_work spectrum_work;
  double most = 0.0;
  hard_must(fb_exact_spectrum_solve(&exact, &spectrum_work, &spectrum, &state, &input, modes), "spectrum");
  for (int k = 0; k < spectrum.n; k++) {
    most = fmax(most, fabs((double)spectrum.re[k]) / (double)spectrum.im[k]);
  }
  return most;
}

/* The figure and the naive one of a row: about the steady state, and about the beam as it is built. */
static void growth_measure(hard_row *row, int modes)
{
  start();
  row->naive_figure = fmax(row->naive_figure, growth(modes));
  hard_must(fb_exact_trim(&exact, &state, &work, &input), "steady state");
  row->figure = fmax(row->figure, growth(modes));
}

/* 1 m, its mass ahead of its line, on a hub of 0.1 m that spins. */
static void ahead(int elements, double offset, double spin)
{
  static const fb_section blade = {.mass = FB_R(0.5), .EA = FB_R(2e6), .GJ = 30, .EI_y = 50, .EI_z = 50};
  fb_section s = blade;
  s.mass_y = (fb_real)offset;
  begin(1.0, elements);
  desc.n_station = 1;
  desc.position[0] = FB_R(0.1);
  hard_must(fb_exact_station_init(&desc.station[0], &s), "section");
  input.w[2] = (fb_real)spin;
}

/* A blade of 117 m: tapered, twisted, bent ahead of its rotor by 4 m, masses and tension centers off its line. */
static void blade(int elements)
{
  begin(117.0, elements);
  desc.n_station = 13;
  desc.position[0] = 3;
  for (int k = 0; k < 13; k++) {
    const double x = k / 12.0, left = 1.0 - x;
    const double flap = 5e10 * pow(left, 3.5) + 2e6, mass = 1400.0 * pow(left, 1.5) + 30.0;
    fb_section s;
    memset(&s, 0, sizeof s);
    s.x = (fb_real)(117.0 * x);
    s.mass = (fb_real)mass;
    s.EA = (fb_real)(2e10 * pow(left, 1.5) + 1e8);
    s.GJ = (fb_real)(0.1 * flap);
    s.EI_y = (fb_real)flap;
    s.EI_z = (fb_real)(3.0 * flap);
    s.i_y = (fb_real)(0.1 * mass * (0.1 + left));
    s.i_z = (fb_real)(0.6 * mass * (0.1 + left));
    s.mass_y = (fb_real)(-0.4 * sin(HARD_PI * (0.1 + 0.8 * x)));
    s.tension_y = (fb_real)(-0.15 * left);
    s.twist = (fb_real)(0.27 * left * left);
    hard_must(fb_exact_station_init(&desc.station[k], &s), "section");
    desc.station[k].curvature[1] = FB_R(-5.8e-4);
  }
  input.w[1] = FB_R(0.79); /* z is the flap direction, ahead of the rotor, y against the motion */
}

void hard_growth(int brief)
{
  static const int few[] = {5, 10, 20, 40}, many[] = {10, 20, 40, 60};
  hard_row row = {.name = "growth",
                  .what = "a beam with its mass ahead of its line spins: 5 to 40 elements, both signs of both",
                  .degree = "spin / first frequency of the beam at rest",
                  .hard = 20.0 / (3.516 * 10.0),
                  .measure = "growth or decay of six modes by the spectrum, of the frequency",
                  .bound = HARD_TOL(1e-9, 2e-4),
                  .naive = "linearized about the beam as it is built"};
  hard_row large = row;
  (void)brief;
  for (int k = 0; k < 16; k++) {
    ahead(few[k / 4], k % 2 ? 0.1 : -0.1, k / 2 % 2 ? 20.0 : -20.0);
    growth_measure(&row, 6);
    hard_progress(k, 20);
  }
  hard_report(&row);
  large.name = "growth blade";
  large.what = "a blade of 117 m in its rotor, tapered, twisted, pre-bent, centers off the line: 10 to 60 elements";
  large.degree = "spin [rad/s]";
  large.hard = 0.79;
  for (int k = 0; k < HARD_COUNT(many); k++) {
    blade(many[k]);
    growth_measure(&large, 10);
    hard_progress(16 + k, 20);
  }
  hard_report(&large);
}

/* ---- motion about such a steady state */

enum { BLOCKS = 7 };

/* Kicked at its tip, the beam flaps and twists by a thousandth of its length: largest difference of the rms of five seconds
   to that of the whole time, of it; dissipation: numerical. */
static double rms_drift(double dissipation, double dt, int blocks)
{
  double square[BLOCKS][2] = {{0}}, mean[2] = {0}, rest[2], drift = 0.0;
  const int count = (int)(5.0 / dt + 0.5);
  ahead(10, 0.1, 20.0);
  desc.dissipation = (fb_real)dissipation;
  start();
  hard_must(fb_exact_trim(&exact, &state, &work, &input), "steady state");
  hard_must(fb_exact_nodes_eval(&exact, node, &state), "nodes");
  rest[0] = (double)node[10].displacement[2];
  rest[1] = (double)node[10].rotation[0];
  input.n_load = 1;
  input.load[0].node = 10;
  input.load[0].axes = FB_AXES_NODE;
  input.load[0].force[2] = FB_R(0.2);
  for (int k = 0; k < blocks * count; k++) {
    input.n_load = k < 0.05 / dt;
    hard_must(fb_exact_step(&exact, &state, &work, &input, (fb_real)dt), "step");
    hard_must(fb_exact_nodes_eval(&exact, node, &state), "nodes");
    square[k / count][0] += pow((double)node[10].displacement[2] - rest[0], 2.0);
    square[k / count][1] += pow((double)node[10].rotation[0] - rest[1], 2.0);
    hard_progress(k, blocks * count);
  }
  for (int k = 0; k < 2 * blocks; k++) {
    mean[k % 2] += square[k / 2][k % 2] / blocks;
  }
  for (int k = 0; k < 2 * blocks; k++) {
    drift = fmax(drift, fabs(sqrt(square[k / 2][k % 2] / mean[k % 2]) - 1.0));
  }
  return drift;
}

void hard_kicked(int brief)
{
  const double dt = 0.002;
  const int blocks = brief ? 2 : BLOCKS;
  hard_row row = {.name = "kicked",
                  .what = "that beam of ten elements, kicked at its tip, flaps and twists as it spins",
                  .degree = "spin / first frequency of the beam at rest",
                  .hard = 20.0 / (3.516 * 10.0),
                  .measure = "rms of flap and of twist in five seconds, against that of the whole time",
                  .bound = 0.01,
                  .naive = "numerical dissipation of 0.1 a step, against what might grow"};
  row.time = 5.0 * blocks;
  row.steps = row.time / dt;
  row.periods = row.time * 35.16 / (2.0 * HARD_PI);
  row.figure = rms_drift(0.0, dt, blocks);
  row.naive_figure = rms_drift(0.1, dt, blocks);
  hard_report(&row);
}

/* ---- free flight */

/* The beam of Simo and Vu-Quoc at a speed along y, thrown off by loads on its root in five seconds: 50 N s along x. */
static void thrown(double speed, double dt)
{
  static const double stiffness[6] = {1e4, 1e4, 1e4, 500.0, 500.0, 500.0},
                      inertia[6] = {1.0, 1.0, 1.0, 20.0, 10.0, 10.0};
  begin(10.0, 10);
  section(stiffness, inertia);
  desc.root = FB_END_FREE;
  input.v[1] = (fb_real)speed;
  start();
  for (int k = 0; k < 5.0 / dt; k++) {
    const double t = (k + 0.5) * dt, torque = t < 2.5 ? 80.0 * t : 400.0 - 80.0 * t;
    input.n_load = 1;
    input.load[0].axes = FB_AXES_INERTIAL;
    input.load[0].force[0] = (fb_real)(0.1 * torque);
    input.load[0].torque[1] = (fb_real)(-0.5 * torque);
    input.load[0].torque[2] = (fb_real)-torque;
    hard_must(fb_exact_step(&exact, &state, &work, &input, (fb_real)dt), "step");
  }
  input.n_load = 0;
}

enum { MOMENTUM, ENERGY };

/* What momentum and energy have changed by, of the 50 N s and 407 J of the motion: p against the impulse of the loads, energy
   since they went. */
static void lost(double error[2], const double p[3], double energy, double speed)
{
  error[MOMENTUM] = hypot(p[0] - 50.0, hypot(p[1] - 10.0 * speed, p[2])) / 50.0;
  error[ENERGY] = fabs(energy) / 407.0;
}

/* A flight after the throw; naive: the velocity of the mass center alone, in section axes of the root, by explicit Euler. */
static void flight_errors(double error[2], double naive[2], double speed, double dt, int count)
{
  const fb_real thrown_at[3] = {5, (fb_real)speed, 0};
  double p[3], before;
  fb_momentum momentum;
  fb_real R[9], v[3], turn[3], seen[3];
  thrown(speed, dt);
  before = total();
  hard_must(fb_exact_nodes_eval(&exact, node, &state), "nodes");
  fb_quat_to_mat33(R, node[0].quat);
  fb_mat33_mulT_vec3(v, R, thrown_at);
  for (int k = 0; k < count; k++) {
    hard_must(fb_exact_step(&exact, &state, &work, &input, (fb_real)dt), "step");
    hard_must(fb_exact_nodes_eval(&exact, node, &state), "nodes");
    fb_vec3_cross(turn, v, node[0].angular_rate);
    for (int i = 0; i < 3; i++) {
      v[i] += (fb_real)dt * turn[i];
    }
    hard_progress(k, count);
  }
  hard_must(fb_exact_momentum_eval(&exact, &momentum, &state), "momentum");
  for (int i = 0; i < 3; i++) {
    p[i] = (double)momentum.linear[i];
  }
  lost(error, p, total() - before, speed);
  fb_quat_to_mat33(R, node[0].quat);
  fb_mat33_mul_vec3(seen, R, v);
  for (int i = 0; i < 3; i++) {
    p[i] = 10.0 * (double)seen[i];
  }
  lost(naive, p, 5.0 * (pow(hard_length(v), 2.0) - 25.0 - speed * speed), speed);
}

void hard_thrown(int brief)
{
  static const double speeds[] = {0.0, 250.0, 7500.0};
  const double dt = 0.01;
  const int count = brief ? 500 : 10000;
  hard_row row = {.what = "a very flexible beam of ten elements is thrown off and flies on",
                  .degree = "speed [m/s]",
                  .naive = "velocity of the mass center in axes that turn with the root, explicit Euler"};
  row.steps = count;
  row.time = count * dt;
  row.periods = row.time * 22.373 * sqrt(500.0 / 1e4) / (2.0 * HARD_PI);
  for (int k = 0; k < HARD_COUNT(speeds); k++) {
    const double faster = speeds[k] / 5.0; /* than what the loads make of it: rounding counts by that, and its square */
    double error[2], naive[2];
    flight_errors(error, naive, speeds[k], dt, count);
    for (int i = 0; i < 2; i++) {
      row.name = i == MOMENTUM ? "thrown momentum" : "thrown energy";
      row.measure = i == MOMENTUM ? "momentum against the impulse of the loads, of it"
                                  : "change of the energy, of that of the motion";
      row.hard = speeds[k];
      row.figure = error[i];
      row.naive_figure = naive[i];
      row.bound = i == MOMENTUM ? HARD_TOL(1e-12, 1e-4) + 100.0 * HARD_EPSILON * faster
                                : HARD_TOL(1e-8, 1e-3) + 10.0 * HARD_EPSILON * faster * faster;
      hard_report(&row);
    }
  }
}

/* ---- gravity */

/* A clamped helix falls under its weight: largest change of the energy, of the 57 J of its fall. As forces: of the nodes,
   turned to section axes at the start of each step, as one would hand them to a beam that knows no gravity. */
static double fall_error(double dt, int count, int forces)
{
  static const double stiffness[6] = {1e4, 5e3, 5e3, 80.0, 100.0, 100.0},
                      inertia[6] = {1.0, 1.0, 1.0, 2e-3, 1e-3, 1e-3};
  double before = 0.0, most = 0.0;
  begin(5.0, 8);
  section(stiffness, inertia);
  desc.station[0].curvature[0] = desc.station[0].curvature[2] = FB_R(0.3);
  desc.gravity[2] = forces ? 0 : FB_R(-9.81);
  desc.iterations = 20;
  start();
  for (int k = 0; k <= count; k++) {
    double energy = total();
    hard_must(fb_exact_nodes_eval(&exact, node, &state), "nodes");
    input.n_load = forces ? 8 : 0;
    for (int j = 1; j <= input.n_load; j++) {
      fb_load *const load = &input.load[j - 1];
      const double weight = 9.81 * (j < 8 ? 0.625 : 0.3125);
      const fb_real down[3] = {0, 0, (fb_real)-weight};
      fb_real R[9];
      load->node = j;
      load->axes = FB_AXES_NODE;
      fb_quat_to_mat33(R, node[j].quat);
      fb_mat33_mulT_vec3(load->force, R, down);
      energy += weight * (double)node[j].position[2];
    }
    before = k == 0 ? energy : before;
    most = fmax(most, fabs(energy - before) / 57.0);
    if (fb_exact_step(&exact, &state, &work, &input, (fb_real)dt) != FB_OK) {
      return HUGE_VAL;
    }
    hard_progress(k, count);
  }
  return most;
}

void hard_helix(int brief)
{
  const double dt = 0.005;
  const int count = brief ? 2000 : 20000;
  hard_row row = {.name = "helix",
                  .what = "a clamped helix of eight elements falls under its weight and swings",
                  .degree = "drop of its tip / length",
                  .hard = 0.9,
                  .measure = "change of the energy, of that of the fall",
                  .naive = "its weight in section axes from the start of each step"};
  row.bound = HARD_TOL(2e-13, brief ? 1e-4 : 5e-3); /* 1e-11 J */
  row.steps = count;
  row.time = count * dt;
  row.periods = row.time * 3.516 * sqrt(100.0 / 625.0) / (2.0 * HARD_PI);
  row.figure = fall_error(dt, count, 0);
  row.naive_figure = fall_error(dt, count, 1);
  hard_report(&row);
}
