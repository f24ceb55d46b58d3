/* rotor - a helicopter rotor of four articulated, flexible blades: how its disc answers to the pitch of the blades.
   The shaft turns at a prescribed rate, the blades hang on hinges for lag and flap (with a lag damper), and on those by
   their pitch bearings, whose angles are prescribed: collective and cyclic. Strips carry the lift of thin airfoils,
   quasi-steady, in a uniform inflow.
   Blade azimuth psi_k = psi + k pi/2, psi = 0 downwind; pitch and flap
     theta = theta_0 + theta_1c cos psi + theta_1s sin psi,   beta = beta_0 + beta_1c cos psi + beta_1s sin psi
   with beta from multiblade (Coleman) coordinates of the tips: coning, and tilt of the disc.
   Checks: the answer in hover against rigid blades in closed form; the balances of energy and of angular momentum about
   the shaft. Its flap in vacuum: rotor_flap.c.
   Exit: 0 well, 1 a check failed or the motion left the model, 2 bad options or a file that cannot be written. */
#define _POSIX_C_SOURCE 200809L /* popen, for gnuplot */
#include "tools/capacities.h"   /* of build/flexbeam: larger models than by default */
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#define PROGRAM "rotor"
#include "common/check.h"
#include "common/articulated_rotor.h"
#include "common/balance.h"
#include "common/options.h"
#include "common/output.h"
#include "common/plot.h"

static fb_body model[MODELS];
static fb_system rotor;
static fb_system_work work;
static const int turns = 30, steps_per_turn = 360; /* of a run */
static rotor_data data = {44, 5, 0.25, 5.5, 9000, 130000, 0, 2000, 0.27, 5.7, 0.01, 1.225, 0, 8, 0, 2};

static const char help[] =
    "rotor - answer of a rotor of four articulated, flexible blades to collective and cyclic pitch\n"
    "usage: rotor [options]\n"
    "  --collective A    [deg] (8)\n"
    "  --cyclic-cos A    [deg] (0)\n"
    "  --cyclic-sin A    [deg] (2)\n"
    "  --out FILE        CSV of the run with flexible blades (rotor.csv); beside it a picture if gnuplot is there\n"
    "  --help            this text\n"
    "The closed forms are those of small angles: at a steep collective the checks fail.\n";

static int read_option(void *out, const char *name, const char *text)
{
  const number_option numbers[] = {{"--collective", &data.collective, -30, 30},
                                   {"--cyclic-cos", &data.cyclic_cos, -20, 20},
                                   {"--cyclic-sin", &data.cyclic_sin, -20, 20}};
  return strcmp(name, "--out") == 0 ? read_out(out, text) : read_number(numbers, 3, name, text);
}

/* ---- the model */

/* ---- a run */

typedef double strip_loads[BLADES][STRIPS][2]; /* [N] along y, z of the section */

typedef struct scene {
  fb_system_state state;
  fb_system_input input;
  fb_system_motion motion;
  strip_loads loads, before; /* at the beginning of this step and of the one before */
  double thrust;             /* [N] */
  double power, moment;      /* [W] into the rotor, [N m] on it about the shaft, at this instant */
  balance balance;           /* by Simpson's rule over pairs of steps */
  double turned;             /* [N m s] integral of |torque| of the shaft */
} scene;

/* The loads `ahead` of a step after this instant, by the straight line through the last two instants: the stepper takes
   loads as functions of time, and held ones would lag behind the motion that causes them. */
static void set_loads(fb_system_input *input, const scene *s, double ahead)
{
  input->n_load = BLADES * STRIPS;
  for (int k = 0; k < input->n_load; k++) {
    const double *now = s->loads[k / STRIPS][k % STRIPS], *before = s->before[k / STRIPS][k % STRIPS];
    input->load[k].body = BLADE(k / STRIPS);
    input->load[k].load = (fb_load){.node = 1 + k % STRIPS, .axes = FB_AXES_NODE};
    for (int i = 0; i < 2; i++) {
      input->load[k].load.force[1 + i] = (fb_real)(now[i] + ahead * (now[i] - before[i]));
    }
  }
}

static void node_motion(fb_node_motion *at, const scene *s, int blade, int node)
{
  const int body = BLADE(blade);
  need(fb_body_node_motion_eval(&model[BLADE_MODEL], at, &s->motion.pose[body], &s->motion.motion[body], node), "node");
}

/* A thin airfoil that moves with u = (u_y, u_z) through the air has the circulation Gamma = -a c u_z / 2; lift
   rho Gamma (-u_z, u_y), drag against u. force: in node axes, F: in inertial axes. */
static void strip_force(double force[2], fb_real F[3], const fb_node_motion *at)
{
  const double half = 0.5 * data.density * data.chord * strip_width(&data);
  const fb_real air[3] = {at->velocity[0], at->velocity[1], at->velocity[2] + (fb_real)data.inflow};
  fb_real R[9], u[3], local[3] = {0};
  double y, z, speed;
  fb_quat_to_mat33(R, at->quat);
  fb_mat33_mulT_vec3(u, R, air);
  y = (double)u[1];
  z = (double)u[2];
  speed = sqrt(y * y + z * z);
  local[1] = (fb_real)(force[0] = half * (data.lift_slope * z * z - data.drag * speed * y));
  local[2] = (fb_real)(force[1] = half * (-data.lift_slope * z * y - data.drag * speed * z));
  fb_mat33_mul_vec3(F, R, local);
}

/* Motion and loads at time t; the loads follow from velocities, which do not depend on them. */
static void look(scene *s, double t)
{
  set_drives(&s->input, &data, t);
  need(fb_system_motion_eval(&rotor, model, &work, &s->motion, &s->state, &s->input), "motion");
  s->thrust = s->power = s->moment = 0;
  for (int k = 0; k < BLADES; k++) {
    const double lag = (double)s->motion.joint[CROSS(k)].speed[LAG];
    s->power -= data.lag_damper * lag * lag;
    for (int i = 0; i < STRIPS; i++) {
      fb_node_motion at;
      fb_real F[3], moment[3];
      node_motion(&at, s, k, 1 + i);
      strip_force(s->loads[k][i], F, &at);
      fb_vec3_cross(moment, at.position, F);
      s->thrust += (double)F[2];
      s->power += (double)fb_vec3_dot(F, at.velocity);
      s->moment += (double)moment[2];
    }
  }
  set_loads(&s->input, s, 0);
  need(fb_system_motion_eval(&rotor, model, &work, &s->motion, &s->state, &s->input), "motion");
  s->power += (double)s->motion.power;
  s->moment += (double)s->motion.joint[0].torque[2];
}

static void begin(scene *s)
{
  fb_link_motion start[1 + 2 * BLADES] = {{.q = {0}}};
  memset(s, 0, sizeof *s);
  set_drives(&s->input, &data, 0);
  start[0].speed[0] = s->input.drive[0].rate[0];
  for (int k = 0; k < BLADES; k++) {
    start[BLADE(k)].value[0] = s->input.drive[BLADE(k)].value[0];
    start[BLADE(k)].speed[0] = s->input.drive[BLADE(k)].rate[0];
  }
  need(fb_system_state_init(&rotor, model, &s->state, &work, start, &s->input), "initial state");
  look(s, 0);
  memcpy(s->before, s->loads, sizeof s->loads);
  balance_begin(&s->balance, &rotor, model, &work, &s->state, &s->input);
}

/* Step number k of a run, k = 0, 1, ..; balances after every second one. */
static void step(scene *s, int k)
{
  static fb_system_input middle, end;
  const double dt = 2 * pi / (data.spin * steps_per_turn), t = k * dt;
  s->balance.work += (k % 2 ? 4 : 1) * dt / 3 * s->power;
  s->balance.impulse[2] += (k % 2 ? 4 : 1) * dt / 3 * s->moment;
  s->turned += dt * fabs((double)s->motion.joint[0].drive[0]);
  middle = end = s->input;
  set_drives(&middle, &data, t + 0.5 * dt);
  set_drives(&end, &data, t + dt);
  set_loads(&middle, s, 0.5);
  set_loads(&end, s, 1);
  need(fb_system_rk4_step(&rotor, model, &s->state, &work, &s->input, &middle, &end, (fb_real)dt), "step");
  memcpy(s->before, s->loads, sizeof s->loads);
  look(s, t + dt);
  if (k % 2) {
    s->balance.work += dt / 3 * s->power;
    s->balance.impulse[2] += dt / 3 * s->moment;
    balance_look(&s->balance, &rotor, model, &work, &s->state, &s->input);
  }
}

/* Flap of the blades by the height of their tips. */
static disc look_at_disc(const scene *s, double azimuth)
{
  disc d = {0};
  for (int k = 0; k < BLADES; k++) {
    const double psi = azimuth + blade_azimuth(k);
    fb_node_motion tip;
    double beta;
    node_motion(&tip, s, k, TIP);
    beta = (double)tip.position[2] / (data.radius - data.offset);
    d.coning += beta / BLADES;
    d.tilt_cos += 2 * beta * cos(psi) / BLADES;
    d.tilt_sin += 2 * beta * sin(psi) / BLADES;
    d.differential += (k % 2 ? -beta : beta) / BLADES;
  }
  return d;
}

static void print_row(FILE *file, const scene *s, double t)
{
  const disc d = look_at_disc(s, fmod(data.spin * t, 2 * pi));
  const fb_joint_motion *hinge = &s->motion.joint[CROSS(0)];
  fb_node_motion tip;
  node_motion(&tip, s, 0, TIP);
  fprintf(file, "%.8g,%.8g,%.8g,%.8g,%.8g,%.8g,%.8g,%.8g,%.8g,%.8g,%.8g,%.8g\n", t, d.coning / degree,
          d.tilt_cos / degree, d.tilt_sin / degree, d.differential / degree,
          (double)s->motion.joint[BLADE(0)].value[0] / degree, (double)hinge->value[FLAP] / degree,
          (double)hinge->value[LAG] / degree, (double)tip.displacement[2], (double)tip.displacement[1], s->thrust,
          (double)s->motion.joint[0].drive[0]);
}

static answer respond(const fidelity *f, FILE *file)
{
  static scene s;
  const int per_turn = steps_per_turn, steps = turns * per_turn;
  answer a = {0};
  make_rotor(&rotor, model, &work, &data, f);
  begin(&s);
  for (int k = 0; k < steps; k++) {
    if (file && k % 2 == 0) {
      print_row(file, &s, k * 2 * pi / (data.spin * per_turn));
    }
    step(&s, k);
    if (k >= steps - per_turn) {
      const disc d = look_at_disc(&s, 2 * pi * ((k + 1) % per_turn) / per_turn);
      a.disc.coning += d.coning / per_turn;
      a.disc.tilt_cos += d.tilt_cos / per_turn;
      a.disc.tilt_sin += d.tilt_sin / per_turn;
      a.lag += (double)s.motion.joint[CROSS(0)].value[LAG] / per_turn;
      a.thrust += s.thrust / per_turn;
      a.torque += (double)s.motion.joint[0].drive[0] / per_turn;
    }
  }
  relate(&a, &data);
  a.energy_miss = s.balance.energy_miss / (s.turned * data.spin);
  a.momentum_miss = s.balance.momentum_miss[2] / s.turned;
  return a;
}

static void print_answer(const char *name, const answer *a)
{
  printf("  %-34s %8.4f %8.4f %8.4f %9.4f %8.3f", name, a->disc.coning / degree, a->disc.tilt_cos / degree,
         a->disc.tilt_sin / degree, a->gain, a->phase / degree);
}

/* Rigid blades with the lag hinge locked are the closed form but for squares of the angles: some 0.5 % at 8 degrees.
   Soft blades bend upward under lift that grows outward, which adds to the coning, and hardly to the tilt. */
static void compare(const char *name, const answer *a, const answer *e, double coning, int flexible)
{
  const double part = flexible ? 0.05 : 0.015, miss = a->phase - e->phase;
  printf("%s\n", name);
  if (fabs(e->disc.coning) > 0.1 * degree) {
    check("coning, off by", a->disc.coning / coning - 1, part);
  }
  if (e->gain > 0) {
    check("gain from cyclic pitch to tilt, off that of rigid blades by", a->gain / e->gain - 1, part);
    check("phase, off that of rigid blades by [deg]", atan2(sin(miss), cos(miss)) / degree, flexible ? 5 : 0.5);
  }
}

int main(int argc, char **argv)
{
  static const fidelity fidelities[] = {
      {"rigid blades, lag locked", 0, 0, 0, 0}, {"rigid blades", 0, 1, 0, 0}, {"flexible blades", 1, 1, 0, 0}};
  const char *out = "rotor.csv";
  char svg[512];
  answer all[3], closed;
  FILE *file;
  output_begin(PROGRAM);
  if (read_all(argc, argv, help, read_option, (void *)&out) != 0) {
    return 2;
  }
  if (!(file = output_open(out))) {
    return fail("cannot write", out);
  }
  fputs("t,coning_deg,tilt_cos_deg,tilt_sin_deg,differential_deg,pitch_deg,flap_deg,lag_deg,tip_flap,tip_lag,thrust,"
        "torque\n",
        file);
  data.inflow = hover_inflow(&data);
  closed = expected(&data);
  printf("answer to collective %.3g deg, cyclic %.3g deg cosine, %.3g deg sine; inflow %.3f m/s; last revolution\n",
         data.collective, data.cyclic_cos, data.cyclic_sin, data.inflow);
  puts("                                       coning   cosine     sine      gain   behind      lag    thrust    "
       "torque");
  for (int k = 0; k < 3; k++) {
    all[k] = respond(&fidelities[k], k == 2 ? file : NULL);
    print_answer(fidelities[k].name, &all[k]);
    printf(" %8.3f %9.0f %9.0f\n", all[k].lag / degree, all[k].thrust, all[k].torque);
  }
  if (output_close(file, out)) {
    return 2;
  }
  print_answer("rigid blades, closed form", &closed);
  printf("\n  %-34s %8.4f\n", "flexible blades, beam in tension", flexible_coning(&data) / degree);
  compare(fidelities[0].name, &all[0], &closed, closed.disc.coning, 0);
  compare(fidelities[2].name, &all[2], &closed, flexible_coning(&data), 1);
  printf("balances, flexible blades\n");
  check("energy less work, part of the shaft's work", all[2].energy_miss, FB_SINGLE ? 1e-3 : 1e-5);
  check("angular momentum less impulse, part of the shaft's", all[2].momentum_miss, FB_SINGLE ? 1e-3 : 1e-5);
  printf("curves: %s\n", out);
  other_name(svg, sizeof svg, out, ".svg");
  plot(svg, "set ylabel 'angle [deg]'\nset title 'A rotor from straight blades to its cone and tilt'\n",
       (const curve[]){{out, "1:2", "every ::1 with lines lw 2 lc rgb '#0060ad'", "coning"},
                       {out, "1:3", "every ::1 with lines lw 2 lc rgb '#dd181f'", "tilt, cosine"},
                       {out, "1:4", "every ::1 with lines lw 2 lc rgb '#009e73'", "tilt, sine"}},
       3, stdout);
  return misses != 0;
}
