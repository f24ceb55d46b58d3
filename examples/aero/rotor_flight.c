/* rotor_flight - a rotor of four blades hinged at its center, which flap, bend in both planes and twist, in hover and in
   forward flight: strip theory along the blades, uniform inflow by momentum theory. The shaft is normal to the flight;
   collective pitch is trimmed for a thrust. psi = 0 downwind, flap beta_0 + beta_1c cos psi + beta_1s sin psi of the
   tips in multiblade coordinates.
   Checks: collective, coning and tilt of stiff blades against the closed form of blade-element theory [A11], in hover
   and in flight; soft blades are trimmed for the same thrust.
   Exit: 0 well, 1 a check failed or the motion left the model, 2 bad options or a file that cannot be written. */
#define FB_MAX_BODIES 9 /* hub, four crosses, four blades */
#define FB_MAX_MODES 4
#define FLEXBEAM_IMPLEMENTATION
#include "../../flexbeam.h"
#define PROGRAM "rotor_flight"
#define AIR_BODIES 9
#include "../common/check.h"
#include "../common/articulated_rotor.h"
#include "../common/options.h"
#include "../common/output.h"
#include "airloads.h"
#include "multiblade.h"

static fb_body model[MODELS];
static fb_system rotor;
static fb_system_work work;
static air_table table;
static air flow;

static const char help[] =
    "rotor_flight - thrust, coning and tilt of a rotor in hover and in forward flight\n"
    "usage: rotor_flight [options]\n"
    "  --advance MU    speed of flight by that of the tips (0.15)\n"
    "  --thrust T      [N] (8000)\n"
    "  --out FILE      CSV of the flight: time, thrust, flap in multiblade coordinates, collective (rotor_flight.csv)\n"
    "  --help          this text\n"
    "The closed forms are those of small angles and of a slow flight; blades may bend by a few degrees.\n";

typedef struct options {
  double advance, thrust;
  const char *out;
} options;

static int read_option(void *target, const char *name, const char *text)
{
  options *const o = target;
  const number_option numbers[] = {{"--advance", &o->advance, 0.02, 0.25}, {"--thrust", &o->thrust, 1000, 10000}};
  return strcmp(name, "--out") == 0 ? read_out(&o->out, text) : read_number(numbers, 2, name, text);
}

typedef struct flight {
  double thrust, collective; /* [N], [rad] */
  multiblade flap;           /* [rad] */
} flight;

/* [A11] */
static flight closed_flight(const rotor_data *d, double advance, double thrust)
{
  const double R = d->radius, tip = d->spin * R, area = pi * R * R, mu2 = advance * advance;
  const double lift = 0.5 * BLADES * d->density * d->lift_slope * d->chord * R * tip * tip; /* thrust by angle */
  const double lock = d->density * d->lift_slope * d->chord * R * 3 / d->mass;
  const double lambda = air_momentum_inflow(thrust, d->density, area, advance * tip, 0) / tip;
  const double roll = 0.75 * d->chord / R;
  flight f = {thrust, 0, {0, 0, 0, 0}};
  multiblade *const b = &f.flap;
  for (int k = 0; k < 30; k++) { /* roll, without which the first is exact, is small */
    f.collective = (thrust / lift + lambda / 2 - roll * (b->mean / 2 + advance * b->sine / 2)) / (1.0 / 3 + mu2 / 2);
    b->mean = lock * (f.collective * (1 + mu2) / 8 - lambda / 6 + roll * (b->mean / 6 + advance * b->sine / 8));
    b->cosine =
        -(advance * (8.0 / 3 * f.collective - 2 * lambda) + roll * (4.0 / 3 * b->sine + 2 * advance * b->mean)) /
        (1 - mu2 / 2);
    b->sine = -4.0 / 3 * (advance * b->mean - roll * b->cosine) / (1 + mu2 / 2);
  }
  return f;
}

static multiblade look_at_disc(const fb_system_motion *motion, const rotor_data *d, double azimuth)
{
  double beta[BLADES];
  for (int k = 0; k < BLADES; k++) {
    fb_node_motion tip;
    need(fb_body_node_motion_eval(&model[BLADE_MODEL], &tip, &motion->pose[BLADE(k)], &motion->motion[BLADE(k)], TIP),
         "tip");
    beta[k] = asin((double)tip.position[2] / d->radius);
  }
  return multiblade_of(beta, BLADES, azimuth);
}

/* Means over the last of `turns` revolutions, in the inflow that momentum theory gives for the thrust. Before each the
   collective is changed by what the closed form says of the thrust that is missing. */
static flight fly(rotor_data *d, const fidelity *f, double advance, double thrust, int turns, int steps, FILE *file)
{
  static fb_system_state state;
  static fb_system_input input, middle, end;
  static fb_system_motion motion;
  const double dt = 2 * pi / (d->spin * steps), tip = d->spin * d->radius, area = pi * d->radius * d->radius;
  const double lift = 0.5 * BLADES * d->density * d->lift_slope * d->chord * d->radius * tip * tip;
  const flight first = closed_flight(d, advance, thrust);
  fb_link_motion start[1 + 2 * BLADES] = {{.q = {0}}};
  flight mean = first;
  make_rotor(&rotor, model, &work, d, f);
  air_table_plate(&table, d->lift_slope, 0.35, d->drag);
  memset(&flow, 0, sizeof flow);
  flow.section = (air_section){&table, d->chord, -0.5, 0}; /* hinged, balanced and carried at the quarter chord */
  flow.density = d->density;
  flow.wind[0] = advance * tip;
  flow.axis[2] = 1;
  flow.inflow = air_momentum_inflow(thrust, d->density, area, advance * tip, 0);
  d->collective = first.collective / degree;
  memset(&input, 0, sizeof input);
  input.distributed = air_loads;
  input.user = &flow;
  set_drives(&input, d, 0);
  start[0].speed[0] = input.drive[0].rate[0];
  for (int k = 0; k < BLADES; k++) {
    start[CROSS(k)].value[FLAP] = (fb_real)first.flap.mean;
    start[BLADE(k)].value[0] = input.drive[BLADE(k)].value[0];
  }
  need(fb_system_state_init(&rotor, model, &state, &work, start, &input), "initial state");
  for (int pass = 0; pass < turns; pass++) {
    d->collective += (thrust - mean.thrust) / (lift * (1.0 / 3 + advance * advance / 2)) / degree;
    mean = (flight){0, d->collective * degree, {0, 0, 0, 0}};
    for (int k = 0; k < steps; k++) {
      const double t = (pass * steps + k) * dt;
      multiblade now;
      double push = 0;
      set_drives(&input, d, t);
      middle = end = input;
      set_drives(&middle, d, t + 0.5 * dt);
      set_drives(&end, d, t + dt);
      need(fb_system_motion_eval(&rotor, model, &work, &motion, &state, &input), "motion");
      for (int i = 0; i < BLADES; i++) {
        push += flow.force[BLADE(i)][2];
      }
      now = look_at_disc(&motion, d, fmod(d->spin * t, 2 * pi));
      mean.thrust += push / steps;
      mean.flap.mean += now.mean / steps;
      mean.flap.cosine += now.cosine / steps;
      mean.flap.sine += now.sine / steps;
      if (file && k % 4 == 0) {
        fprintf(file, "%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g\n", t, push, now.mean, now.cosine, now.sine, now.differential,
                mean.collective);
      }
      need(fb_system_rk4_step(&rotor, model, &state, &work, &input, &middle, &end, (fb_real)dt), "step");
    }
  }
  return mean;
}

static void print_flight(const char *name, const flight *f)
{
  printf("%s: collective %.3f deg, coning %.3f, tilt %.3f and %.3f deg, thrust %.1f N\n", name, f->collective / degree,
         f->flap.mean / degree, f->flap.cosine / degree, f->flap.sine / degree, f->thrust);
}

int main(int argc, char **argv)
{
  const fidelity stiff = {"stiff blades", 1, 0, 3e4}, soft = {"soft blades", 1, 0, 3e4};
  rotor_data d = {44, 5, 0, 4, 4e6, 4e6, 0, 0, 0.12, 2 * pi, 0.01, 1.225, 0, 0, 0, 0}, bends = d;
  options o = {0.15, 8000, "rotor_flight.csv"};
  flight hover, hover_form, cruise, form, soft_cruise;
  FILE *file;
  output_begin(PROGRAM);
  if (read_all(argc, argv, help, read_option, &o) != 0) {
    return 2;
  }
  bends.ei_flap = 2e4;
  bends.ei_lag = 2e5;
  hover_form = closed_flight(&d, 0, o.thrust);
  hover = fly(&d, &stiff, 0, o.thrust, 20, 360, NULL);
  print_flight("hover", &hover);
  print_flight("closed form", &hover_form);
  check("thrust, off the wanted by", hover.thrust / o.thrust - 1, 1e-3);
  check("collective, off the closed form by", hover.collective / hover_form.collective - 1, 0.01);
  check("coning, off the closed form by", hover.flap.mean / hover_form.flap.mean - 1, 0.01);
  check("tilt of the disc [rad]", hypot(hover.flap.cosine, hover.flap.sine), 1e-4);
  form = closed_flight(&d, o.advance, o.thrust);
  if (!(file = fopen(o.out, "w"))) {
    return fail("cannot write", o.out);
  }
  fputs("t,thrust,coning,tilt_cos,tilt_sin,differential,collective\n", file);
  cruise = fly(&d, &stiff, o.advance, o.thrust, 20, 360, NULL);
  soft_cruise = fly(&bends, &soft, o.advance, o.thrust, 20, 360, file);
  if (output_close(file, o.out)) {
    return 2;
  }
  print_flight("flight", &cruise);
  print_flight("closed form", &form);
  check("thrust, off the wanted by", cruise.thrust / o.thrust - 1, 1e-3);
  check("collective, off the closed form by", cruise.collective / form.collective - 1, 0.015);
  check("coning, off the closed form by", cruise.flap.mean / form.flap.mean - 1, 0.015);
  check("tilt backward, off the closed form by", cruise.flap.cosine / form.flap.cosine - 1, 0.015);
  check("tilt sideward, off the closed form by", cruise.flap.sine / form.flap.sine - 1, 0.03);
  print_flight("soft blades", &soft_cruise);
  check("thrust of soft blades, off the wanted by", soft_cruise.thrust / o.thrust - 1, 2e-3);
  printf("curves: %s\n", o.out);
  return misses != 0;
}
