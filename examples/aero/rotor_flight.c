/* rotor_flight - a rotor of four blades (-DROTOR_BLADES=3: three) on hinges for flap and lag at an offset, which bend in
   both planes and twist, in hover and in forward flight: strip theory along the blades, uniform inflow by momentum
   theory. The shaft is normal to the flight. Collective and cyclic pitch are trimmed by Newton's method for a thrust and a tilt of the disc. psi = 0
   downwind, pitch theta_0 + theta_1c cos psi + theta_1s sin psi, flap and lag in multiblade coordinates.
   Checks: frequencies of the hinges and of torsion [A12], [A13]; trim, flap and hub moments of stiff blades against
   rigid ones in closed form [A11], in hover and in flight; blades that bend and twist are trimmed to the same.
   Exit: 0 well, 1 a check failed or the motion left the model, 2 bad options or a file that cannot be written. */
#define _POSIX_C_SOURCE 200809L  /* output.h */
#include "../tools/capacities.h" /* of build/flexbeam: larger models than by default */
#define FLEXBEAM_IMPLEMENTATION
#include "../../flexbeam.h"
#define PROGRAM "rotor_flight"
#define AIR_BODIES (1 + 2 * BLADES)
#include "../common/check.h"
#include "../common/articulated_rotor.h"
#include "../common/options.h"
#include "../common/output.h"
#include "airloads.h"
#include "hinged.h"
#include "multiblade.h"

enum { STEPS = 360 }; /* per revolution */
static fb_body model[MODELS];
static fb_system rotor;
static fb_system_work work;
static fb_system_analyse_work analyse;
static air_table table;
static air flow;

static const char help[] =
    "rotor_flight - trim of an articulated rotor in hover and in forward flight\n"
    "usage: rotor_flight [options]\n"
    "  --advance MU     speed of flight by that of the tips (0.15)\n"
    "  --thrust T       [N] (8000)\n"
    "  --tilt-cos B     [deg] of the disc that the trim is to reach, cosine: backward is negative (0)\n"
    "  --tilt-sin B     [deg] sine (0)\n"
    "  --offset E       [m] of the hinges for flap and lag; the radius is 5 (0.2)\n"
    "  --lag-damper D   [N m s/rad] on each lag hinge (2000)\n"
    "  --gj GJ          [N m^2] torsional stiffness of the soft blades (3000)\n"
    "  --out FILE       CSV of the flight of soft blades: time, thrust, flap in multiblade coordinates, lag, pitch\n"
    "                   (rotor_flight.csv)\n"
    "  --help           this text\n"
    "The closed forms are those of small angles and of a slow flight; blades may bend by a few degrees.\n";

typedef struct options {
  double advance, thrust, tilt[2], offset, lag_damper, gj;
  const char *out;
} options;

static int read_option(void *target, const char *name, const char *text)
{
  options *const o = target;
  const number_option numbers[] = {{"--advance", &o->advance, 0.02, 0.25},
                                   {"--thrust", &o->thrust, 1000, 10000},
                                   {"--tilt-cos", &o->tilt[0], -2, 2},
                                   {"--tilt-sin", &o->tilt[1], -2, 2},
                                   {"--offset", &o->offset, 0.1, 0.5},
                                   {"--lag-damper", &o->lag_damper, 100, 2000},
                                   {"--gj", &o->gj, 1000, 1e5}};
  return strcmp(name, "--out") == 0 ? read_out(&o->out, text) : read_number(numbers, 7, name, text);
}

/* ---- a run */

typedef struct ride { /* assignment is a snapshot */
  fb_system_state state;
  rotor_data data; /* with the pitch that it has now */
  double t;        /* [s] */
} ride;

static void set_pitch(rotor_data *d, const double pitch[3])
{
  d->collective = pitch[0] / degree;
  d->cyclic_cos = pitch[1] / degree;
  d->cyclic_sin = pitch[2] / degree;
}

/* The drives while the pitch goes from one to the other, smoothly within the first revolution after `begin`, value,
   rate and acceleration together. Do not let it jump: a jump of a prescribed angle keeps the momenta of the modes in
   axes that turn with it, which is a kick of spin x radius x jump across the blade. */
static void move_pitch(fb_system_input *input, const rotor_data *from, const rotor_data *to, double begin, double t)
{
  static fb_system_input old;
  const double T = 2 * pi / to->spin, s = fmin(1, (t - begin) / T);
  const double part = s * s * (3 - 2 * s), part_rate = 6 * s * (1 - s) / T;
  const double part_acceleration = s < 1 ? 6 * (1 - 2 * s) / (T * T) : 0;
  set_drives(&old, from, t);
  set_drives(input, to, t);
  for (int k = 0; k < BLADES; k++) {
    const fb_drive *const o = &old.drive[BLADE(k)];
    fb_drive *const p = &input->drive[BLADE(k)];
    const double value = (double)o->value[0], rate = (double)o->rate[0], acceleration = (double)o->acceleration[0];
    const double by = (double)p->value[0] - value, by_rate = (double)p->rate[0] - rate;
    const double by_acceleration = (double)p->acceleration[0] - acceleration;
    p->value[0] = (fb_real)(value + part * by);
    p->rate[0] = (fb_real)(rate + part * by_rate + part_rate * by);
    p->acceleration[0] =
        (fb_real)(acceleration + part * by_acceleration + 2 * part_rate * by_rate + part_acceleration * by);
  }
}

/* Adds to the means what the rotor does now. */
static void look(flight *mean, const fb_system_motion *motion, const rotor_data *d, double t, FILE *file)
{
  double beta[BLADES], push = 0, lag = 0;
  multiblade now;
  for (int k = 0; k < BLADES; k++) {
    fb_node_motion tip;
    need(fb_body_node_motion_eval(&model[BLADE_MODEL], &tip, &motion->pose[BLADE(k)], &motion->motion[BLADE(k)], TIP),
         "tip");
    beta[k] = asin((double)tip.position[2] / (d->radius - d->offset));
    push += flow.force[BLADE(k)][2];
    lag += (double)motion->joint[CROSS(k)].value[LAG] / BLADES;
  }
  now = multiblade_of(beta, BLADES, fmod(d->spin * t, 2 * pi));
  mean->thrust += push / STEPS;
  mean->lag += lag / STEPS;
  mean->flap[0] += now.mean / STEPS;
  mean->flap[1] += now.cosine / STEPS;
  mean->flap[2] += now.sine / STEPS;
  for (int i = 0; i < 2; i++) {
    mean->hub_moment[i] -= (double)motion->joint[0].torque[i] / STEPS;
  }
  if (file) {
    fprintf(file, "%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g\n", t, push, now.mean, now.cosine, now.sine,
            now.differential, lag, mean->pitch[0], mean->pitch[1], mean->pitch[2]);
  }
}

/* The pitch moves there within the first of these revolutions; means over the last. */
static flight fly(ride *r, const double pitch[3], int turns, FILE *file)
{
  static fb_system_input input, middle, end;
  static fb_system_motion motion;
  const double dt = 2 * pi / (r->data.spin * STEPS), begin = r->t;
  const rotor_data from = r->data;
  flight mean = {{pitch[0], pitch[1], pitch[2]}, {0, 0, 0}, 0, 0, {0, 0}}, unused = mean;
  memset(&input, 0, sizeof input);
  input.distributed = air_loads;
  input.user = &flow;
  middle = end = input;
  set_pitch(&r->data, pitch);
  for (int k = 0; k < turns * STEPS; k++) {
    const double t = begin + k * dt;
    const int last = k >= (turns - 1) * STEPS;
    move_pitch(&input, &from, &r->data, begin, t);
    move_pitch(&middle, &from, &r->data, begin, t + 0.5 * dt);
    move_pitch(&end, &from, &r->data, begin, t + dt);
    if (last || (file && k % 4 == 0)) {
      need(fb_system_motion_eval(&rotor, model, &work, &motion, &r->state, &input), "motion");
      look(last ? &mean : &unused, &motion, &r->data, t, k % 4 == 0 ? file : NULL);
    }
    need(fb_system_rk4_step(&rotor, model, &r->state, &work, &input, &middle, &end, (fb_real)dt), "step");
  }
  r->t = begin + turns * STEPS * dt;
  return mean;
}

/* A rotor in the air, the motion as the closed form has it. */
static void begin_ride(ride *r, const rotor_data *d, const fidelity *f, double advance, const flight *first)
{
  static fb_system_input input;
  const double tip = d->spin * d->radius, area = pi * d->radius * d->radius;
  fb_link_motion start[1 + 2 * BLADES] = {{.q = {0}}};
  make_rotor(&rotor, model, &work, d, f);
  air_table_plate(&table, d->lift_slope, 0.35, d->drag);
  memset(&flow, 0, sizeof flow);
  flow.section = (air_section){&table, d->chord, -0.5, 0}; /* hinged, balanced and carried at the quarter chord */
  flow.density = d->density;
  flow.wind[0] = advance * tip;
  flow.axis[2] = 1;
  flow.inflow = air_momentum_inflow(first->thrust, d->density, area, advance * tip, 0);
  r->data = *d;
  r->t = 0;
  set_pitch(&r->data, first->pitch);
  memset(&input, 0, sizeof input);
  input.distributed = air_loads;
  input.user = &flow;
  set_drives(&input, &r->data, 0);
  start[0].speed[0] = input.drive[0].rate[0];
  for (int k = 0; k < BLADES; k++) {
    const double c = cos(blade_azimuth(k)), s = sin(blade_azimuth(k)), *const beta = first->flap;
    start[CROSS(k)].value[FLAP] = (fb_real)(beta[0] + beta[1] * c + beta[2] * s);
    start[CROSS(k)].speed[FLAP] = (fb_real)(d->spin * (beta[2] * c - beta[1] * s));
    start[BLADE(k)].value[0] = input.drive[BLADE(k)].value[0];
    start[BLADE(k)].speed[0] = input.drive[BLADE(k)].rate[0];
  }
  need(fb_system_state_init(&rotor, model, &r->state, &work, start, &input), "initial state");
}

/* ---- trim */

/* What is missing: thrust by that wanted, tilt in radians. */
static double missing(double miss[3], const flight *f, const flight *wanted)
{
  miss[0] = f->thrust / wanted->thrust - 1;
  miss[1] = f->flap[1] - wanted->flap[1];
  miss[2] = f->flap[2] - wanted->flap[2];
  return fmax(fabs(miss[0]), fmax(fabs(miss[1]), fabs(miss[2])));
}

/* Newton's method for the thrust and the tilt that are wanted, from this pitch; the Jacobian by forward differences,
   once: each from the same snapshot. Ends at 1e-5 or after six iterations; what is missing then is the caller's to
   check. */
static flight trim(ride *r, const flight *wanted, const double pitch[3], int turns, int *iterations)
{
  const double change = 0.2 * degree;
  fb_real A[9], b[3], x[3], scale[3];
  double miss[3], other[3];
  int perm[3];
  flight f = fly(r, pitch, turns, NULL);
  const ride base = *r;
  double most = missing(miss, &f, wanted);
  for (int j = 0; j < 3; j++) {
    flight g = f;
    *r = base;
    g.pitch[j] += change;
    g = fly(r, g.pitch, turns, NULL);
    missing(other, &g, wanted);
    for (int i = 0; i < 3; i++) {
      A[3 * i + j] = (fb_real)((other[i] - miss[i]) / change);
    }
  }
  *r = base;
  need(fb_lu_factor(A, perm, scale, 3), "trim");
  for (*iterations = 0; *iterations < 6 && most > 1e-5; ++*iterations) {
    for (int i = 0; i < 3; i++) {
      b[i] = (fb_real)-miss[i];
    }
    fb_lu_solve(x, A, perm, b, 3);
    for (int j = 0; j < 3; j++) {
      f.pitch[j] += (double)x[j];
    }
    f = fly(r, f.pitch, turns, NULL);
    most = missing(miss, &f, wanted);
  }
  return f;
}

static void print_flight(const char *name, const flight *f)
{
  printf("%-12s pitch %.3f %.3f %.3f deg, flap %.3f %.3f %.3f deg, lag %.3f deg, thrust %.1f N, hub %.1f %.1f N m\n",
         name, f->pitch[0] / degree, f->pitch[1] / degree, f->pitch[2] / degree, f->flap[0] / degree,
         f->flap[1] / degree, f->flap[2] / degree, f->lag / degree, f->thrust, f->hub_moment[0], f->hub_moment[1]);
}

/* ---- what the hinges and the torsion do without flight */

/* The eigenvalue with the frequency nearest to this. */
static void nearest(double *growth, double *frequency, const fb_spectrum *s, double wanted)
{
  int at = 0;
  for (int k = 1; k < s->n; k++) {
    at = fabs((double)s->im[k] - wanted) < fabs((double)s->im[at] - wanted) ? k : at;
  }
  *growth = (double)s->re[at];
  *frequency = (double)s->im[at];
}

/* [A12] of rigid blades in vacuum */
static void check_hinges(const rotor_data *d)
{
  static fb_spectrum spectrum;
  static fb_system_state state;
  static fb_system_input input;
  const fidelity rigid = {"rigid blades", 0, 1, 0, 0};
  const hinge_numbers form = hinge_frequencies(d);
  const double W = d->spin, damped = W * sqrt(form.lag * form.lag - form.lag_growth * form.lag_growth / (W * W));
  fb_link_motion start[1 + 2 * BLADES] = {{.q = {0}}};
  double growth, frequency;
  make_rotor(&rotor, model, &work, d, &rigid);
  set_drives(&input, d, 0);
  start[0].speed[0] = input.drive[0].rate[0];
  need(fb_system_state_init(&rotor, model, &state, &work, start, &input), "state");
  need(fb_system_spectrum_solve(&rotor, model, &analyse, &spectrum, &state, &input), "spectrum");
  nearest(&growth, &frequency, &spectrum, W * form.flap);
  printf("hinges at %.3g m, rigid blades in vacuum: flap %.5f, lag %.5f per revolution\n", d->offset, form.flap,
         form.lag);
  check("flap frequency, off the closed form by", frequency / (W * form.flap) - 1, 1e-4);
  nearest(&growth, &frequency, &spectrum, damped);
  check("lag frequency under its damper, off the closed form by", frequency / damped - 1, 1e-3);
  check("lag growth under its damper, off the closed form by", growth / form.lag_growth - 1, 1e-3);
}

/* [A13] of blades that twist but hardly bend, in hover, about the trimmed state */
static void check_torsion(const rotor_data *d, double GJ, const flight *hover)
{
  static fb_spectrum spectrum;
  static fb_system_input input;
  static ride r;
  const fidelity twists = {"torsion", 1, 0, GJ, 0};
  const air_table thin = {2, {-pi, pi}, {-pi * d->lift_slope, pi * d->lift_slope}, {d->drag, d->drag}, {0}};
  double growth, frequency, form_growth, form;
  begin_ride(&r, d, &twists, 0, hover);
  table = thin; /* for differences that stall does not disturb */
  memset(&input, 0, sizeof input);
  input.distributed = air_loads;
  input.user = &flow;
  set_drives(&input, &r.data, 0);
  need(fb_system_trim(&rotor, model, &r.state, &analyse, &input), "equilibrium");
  need(fb_system_spectrum_solve(&rotor, model, &analyse, &spectrum, &r.state, &input), "spectrum");
  torsion_numbers(&form, &form_growth, d, GJ);
  nearest(&growth, &frequency, &spectrum, form);
  printf("torsion of blades of GJ = %g N m^2 in hover: %.2f rad/s, growth %.2f 1/s; closed form %.2f, %.2f\n", GJ,
         frequency, growth, form, form_growth);
  check("frequency of torsion, off the closed form by", frequency / form - 1, 3e-3);
  check("growth of torsion, off the closed form by", growth / form_growth - 1, 0.02);
}

/* ---- flights */

static flight wanted_flight(const rotor_data *d, double advance, double thrust, const double tilt[2])
{
  const double tip = d->spin * d->radius, area = pi * d->radius * d->radius;
  const double lambda = air_momentum_inflow(thrust, d->density, area, advance * tip, 0) / tip;
  const flight given = {{0}, {0, tilt[0] * degree, tilt[1] * degree}, 0, thrust, {0, 0}};
  return hinged_solve(d, advance, lambda, given, 1);
}

static void check_trim(const flight *f, const flight *form)
{
  double miss[3];
  check("thrust and tilt, off the wanted by", missing(miss, f, form), 1e-5);
  check("collective, off the closed form by", f->pitch[0] / form->pitch[0] - 1, 0.015);
  check("cyclic, off the closed form by, of the collective",
        hypot(f->pitch[1] - form->pitch[1], f->pitch[2] - form->pitch[2]) / form->pitch[0], 0.015);
  check("coning, off the closed form by", f->flap[0] / form->flap[0] - 1, 0.015);
}

/* The flap and the hub moments of this pitch, untrimmed; inflow as it is. */
static void check_answer(ride *r, double advance, const double pitch[3])
{
  const double lambda = flow.inflow / (r->data.spin * r->data.radius);
  const flight given = {{pitch[0], pitch[1], pitch[2]}, {0}, 0, 1, {0, 0}};
  const flight form = hinged_solve(&r->data, advance, lambda, given, 0), f = fly(r, pitch, 7, NULL);
  double size = hypot(form.flap[1], form.flap[2]);
  print_flight("untrimmed", &f);
  print_flight("closed form", &form);
  check("tilt, cosine, off the closed form by, of the tilt", (f.flap[1] - form.flap[1]) / size, 0.015);
  check("tilt, sine, off the closed form by, of the tilt", (f.flap[2] - form.flap[2]) / size, 0.015);
  size = hypot(form.hub_moment[0], form.hub_moment[1]);
  check("hub moments, off the closed form by, of their size",
        hypot(f.hub_moment[0] - form.hub_moment[0], f.hub_moment[1] - form.hub_moment[1]) / size, 0.02);
}

/* Stiff blades: what they do with some cyclic pitch, and the trim from there. */
static void fly_stiff(const char *name, const rotor_data *d, double advance, const flight *form, const double cyclic[2])
{
  static ride r;
  const fidelity stiff = {"stiff blades", 1, 0, 3e4, 0.05};
  const double pitch[3] = {form->pitch[0], cyclic[0], cyclic[1]};
  int iterations;
  flight f;
  begin_ride(&r, d, &stiff, advance, form);
  printf("%s of stiff blades\n", name);
  check_answer(&r, advance, pitch);
  f = trim(&r, form, pitch, 7, &iterations);
  printf("%s of stiff blades, trimmed in %d iterations\n", name, iterations);
  print_flight("trimmed", &f);
  print_flight("closed form", form);
  check_trim(&f, form);
}

/* Blades that bend and twist on lag hinges, trimmed to the same; the CSV is of the trimmed flight. */
static int fly_soft(const rotor_data *d, double GJ, double advance, const flight *form, const char *out)
{
  static ride r;
  const fidelity soft = {"soft blades", 1, 1, GJ, 0.01};
  rotor_data bends = *d;
  double miss[3];
  int iterations;
  flight f;
  FILE *const file = output_open(out);
  if (!file) {
    return fail("cannot write", out);
  }
  bends.ei_flap = 2e4;
  bends.ei_lag = 2e5;
  begin_ride(&r, &bends, &soft, advance, form);
  f = trim(&r, form, form->pitch, 10, &iterations);
  printf("flight of soft blades with lag hinges, trimmed in %d iterations\n", iterations);
  print_flight("trimmed", &f);
  check("thrust and tilt of soft blades, off the wanted by", missing(miss, &f, form), 1e-5);
  fputs("t,thrust,coning,tilt_cos,tilt_sin,differential,lag,collective,cyclic_cos,cyclic_sin\n", file);
  fly(&r, f.pitch, 3, file);
  return output_close(file, out);
}

int main(int argc, char **argv)
{
  options o = {0.15, 8000, {0, 0}, 0.2, 2000, 3000, "rotor_flight.csv"};
  rotor_data d = {44, 5, 0, 4, 4e6, 4e6, 0, 0, 0.12, 2 * pi, 0.01, 1.225, 0, 0, 0, 0};
  const double level[2] = {0, 0}, cyclic[2] = {degree, 2 * degree};
  flight form;
  output_begin(PROGRAM);
  if (read_all(argc, argv, help, read_option, &o) != 0) {
    return 2;
  }
  d.offset = o.offset;
  d.lag_damper = o.lag_damper;
  form = wanted_flight(&d, 0, o.thrust, level);
  check_hinges(&d);
  check_torsion(&d, o.gj, &form);
  fly_stiff("hover", &d, 0, &form, cyclic);
  form = wanted_flight(&d, o.advance, o.thrust, o.tilt);
  fly_stiff("flight", &d, o.advance, &form, level); /* without cyclic pitch the disc blows back */
  if (fly_soft(&d, o.gj, o.advance, &form, o.out)) {
    return 2;
  }
  printf("curves: %s\n", o.out);
  return misses != 0;
}
