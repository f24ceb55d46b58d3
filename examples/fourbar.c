/* fourbar - a four-bar linkage whose coupler bends: a closed loop of crank, coupler and rocker.
   The tree is ground - crank - coupler and ground - rocker; a further revolute joint between the tips of coupler and
   rocker closes the loop. A prescribed angle turns the crank, from rest up to a steady rate. Three runs: the rigid
   linkage, whose rocker has a closed form; the same with a flexible coupler; and a rigid parallelogram, which goes flat
   twice a turn, where the loop alone does not say how it moves on: its momentum does.
   Exit: 0 well, 1 a check failed or the motion left the model, 2 bad options. */
#define _POSIX_C_SOURCE 200809L /* popen, for gnuplot */
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#define PROGRAM "fourbar"
#include "common/check.h"
#include "common/options.h"
#include "common/output.h"
#include "common/plot.h"

enum { CRANK, COUPLER, ROCKER, BARS };
enum { TIP = 1, MIDDLE = 2 };                                    /* nodes of a bar */
static const double pi = 3.14159265358979324, first_angle = 0.5; /* [rad] of the crank */

typedef struct linkage {
  const char *name;
  double length[BARS], ground; /* [m] */
  int flexible;
} linkage;

typedef struct options {
  double rate, turns, EI, dt; /* [rad/s], of the crank, [N m^2] of the coupler, [s] */
  const char *out;
} options;

static const char help[] =
    "fourbar - a four-bar linkage with a rigid and with a flexible coupler, and a parallelogram\n"
    "usage: fourbar [options]\n"
    "  --rate W      [rad/s] of the crank when it is up to speed, 1 to 40 (30)\n"
    "  --turns N     of the crank, 2 to 100 (6)\n"
    "  --ei EI       [N m^2] bending stiffness of the coupler (100)\n"
    "  --dt DT       [s] step, at most 1e-3 (1e-4)\n"
    "  --out FILE    CSV of the flexible linkage (fourbar.csv); the rigid one beside it as _rigid.csv, the path of "
    "the\n"
    "                coupler's middle as picture\n"
    "  --help        this text\n"
    "CSV: t [s], angles of crank and rocker [rad], middle of the coupler x, y [m], its deflection [m], gap of the "
    "loop\n"
    "[m], energy and work of the drive [J].\n"
    "Faster cranks, longer steps and softer couplers than the defaults may miss the bounds of the checks (exit 1).\n";

static int read_option(void *target, const char *name, const char *text)
{
  options *const o = target;
  const number_option numbers[] = {{"--rate", &o->rate, 1, 40},
                                   {"--turns", &o->turns, 2, 100},
                                   {"--ei", &o->EI, 1, 1e6},
                                   {"--dt", &o->dt, 1e-6, 1e-3}};
  return strcmp(name, "--out") == 0 ? read_out(&o->out, text) : read_number(numbers, 4, name, text);
}

/* ---- model: bars along x, 1 kg/m; all joints turn about z */

static fb_body model[BARS];
static fb_system mechanism;
static fb_system_work work;

/* The coupler bends in the plane. Its root is a pin: the frame takes its rigid turns, the modes none of them (those of
   a clamped one would leave the pin next to no inertia to turn). EI = 0: rigid. */
static fb_status build_bar(fb_body *body, double length, double EI)
{
  static fb_build_work scratch;
  static fb_beam_desc bar;
  const fb_real L = (fb_real)length;
  const fb_build_desc desc = {.n_part = 1,
                              .part = {{.n_node = 2, .node = {L, L / 2}}},
                              .body = {.effects = EI > 0 ? FB_EFFECTS_FULL : FB_EFFECTS_RIGID,
                                       .base = FB_BASE_PRESCRIBED}}; /* no inertia about its own axis */
  fb_modes_desc keep = {.n_load = 0};
  bar.length = L;
  bar.n_element = 6;
  bar.root = FB_ROOT_PINNED;
  bar.n_station = 1;
  bar.station[0].mass = 1;
  bar.station[0].EI_z = (fb_real)EI;
  bar.station[0].i_z = (fb_real)(EI > 0 ? 1e-4 : 0);
  if (EI > 0) {
    keep.count[FB_KIND_BEND_Y] = 3;
    keep.n_load = 1; /* the pull of the loop */
    keep.load[0].node = bar.n_element;
    keep.load[0].axis = 1;
  }
  return fb_body_build(body, &scratch, &desc, &bar, &keep, 1);
}

static void build(const linkage *l, double EI)
{
  fb_system_desc desc = {.n_body = BARS, .n_loop = 1};
  for (int k = 0; k < BARS; k++) {
    need(build_bar(&model[k], l->length[k], k == COUPLER && l->flexible ? EI : 0), "bar");
    desc.model[k] = k;
    desc.joint[k].kind = FB_JOINT_REVOLUTE;
    desc.joint[k].parent = k == COUPLER ? CRANK : FB_GROUND;
    desc.joint[k].parent_node = k == COUPLER ? TIP : 0;
  }
  desc.joint[CRANK].mode[0] = FB_AXIS_PRESCRIBED;
  desc.joint[ROCKER].position[0] = (fb_real)l->ground;
  desc.loop[0] = (fb_joint_desc){
      .kind = FB_JOINT_REVOLUTE, .parent = COUPLER, .parent_node = TIP, .child = ROCKER, .child_node = TIP};
  need(fb_system_init(&mechanism, &work, model, &desc, BARS), "linkage");
}

/* ---- closed form */

static int is_parallelogram(const linkage *l)
{
  return fabs(l->length[CRANK] - l->length[ROCKER]) + fabs(l->length[COUPLER] - l->ground) <= 0;
}

/* Angle of the rocker, its tip above the line of length e from its pivot to the crank's tip: the triangle over that
   line with the sides of coupler and rocker. A parallelogram changes sides where it is flat: its bars stay parallel. */
static double rocker_angle(const linkage *l, double crank)
{
  const double b = l->length[COUPLER], c = l->length[ROCKER];
  const double x = l->length[CRANK] * cos(crank) - l->ground, y = l->length[CRANK] * sin(crank);
  const double e = sqrt(x * x + y * y);
  return is_parallelogram(l) ? crank : atan2(y, x) - acos((e * e + c * c - b * b) / (2 * e * c));
}

static double coupler_angle(const linkage *l, double crank)
{
  const double r = rocker_angle(l, crank);
  return atan2(l->length[ROCKER] * sin(r) - l->length[CRANK] * sin(crank),
               l->ground + l->length[ROCKER] * cos(r) - l->length[CRANK] * cos(crank));
}

/* Kinetic energy of a parallelogram: crank and rocker turn, the coupler moves along a circle without turning. */
static double parallel_energy(const linkage *l, double rate)
{
  const double a = l->length[CRANK];
  return (a * a * a / 3 + l->length[COUPLER] * a * a / 2) * rate * rate;
}

/* ---- one run */

typedef struct sample {
  double crank, rate, rocker; /* [rad], [rad/s], [rad] */
  double x, y;                /* [m] middle of the coupler */
  double deflection, gap;     /* [m] of the coupler's middle off its chord, of the loop */
  double energy, work, power; /* [J], [J], [W] */
} sample;

typedef struct result {    /* the largest of a run */
  double gap, miss;        /* [m] of the loop, [rad] of the rocker off its closed form */
  double jump;             /* [rad] turn of the rocker in a step beyond what the crank's rate allows */
  double deflection;       /* [m] */
  double balance, highest; /* [J] |energy - work|, energy */
  double energy_miss;      /* of a parallelogram: off its closed form, of the energy at full rate */
} result;

/* The crank from rest to its rate in one turn, T = 4 pi/W: rate W/2 (1 - cos(pi t/T)), then W. */
static void drive(fb_system_input *input, double t, double W)
{
  const double T = 4 * pi / W;
  const int up = t < T;
  fb_drive *d = &input->drive[CRANK];
  d->value[0] = (fb_real)(first_angle + (up ? W / 2 * (t - T / pi * sin(pi * t / T)) : W * (t - T / 2)));
  d->rate[0] = (fb_real)(up ? W / 2 * (1 - cos(pi * t / T)) : W);
  d->acceleration[0] = (fb_real)(up ? W / 2 * pi / T * sin(pi * t / T) : 0);
}

static void look(sample *s, const fb_system_state *state, const fb_system_input *input)
{
  static fb_system_motion motion;
  const fb_state *pose = motion.pose;
  const fb_motion *m = motion.motion;
  fb_node_motion tip, middle, other;
  fb_energy e;
  need(fb_system_motion_eval(&mechanism, model, &work, &motion, state, input), "motion");
  need(fb_body_node_motion_eval(&model[COUPLER], &tip, &pose[COUPLER], &m[COUPLER], TIP), "tip of the coupler");
  need(fb_body_node_motion_eval(&model[COUPLER], &middle, &pose[COUPLER], &m[COUPLER], MIDDLE), "its middle");
  need(fb_body_node_motion_eval(&model[ROCKER], &other, &pose[ROCKER], &m[ROCKER], TIP), "tip of the rocker");
  need(fb_system_energy_eval(&mechanism, model, &work, &e, state, input), "energy");
  s->gap = 0;
  for (int i = 0; i < 3; i++) {
    s->gap = fmax(s->gap, fabs((double)(tip.position[i] - other.position[i])));
  }
  s->crank = (double)input->drive[CRANK].value[0];
  s->rate = (double)input->drive[CRANK].rate[0];
  s->rocker = (double)state->link[ROCKER].x[0];
  s->x = (double)middle.position[0];
  s->y = (double)middle.position[1];
  s->deflection = (double)(middle.displacement[1] - tip.displacement[1] / 2);
  s->energy = (double)(e.kinetic + e.strain);
  s->power = (double)motion.power;
}

static void judge(result *r, const linkage *l, const sample *s, const sample *before, const options *o)
{
  const double off = s->rocker - rocker_angle(l, s->crank);
  r->gap = fmax(r->gap, s->gap);
  r->miss = fmax(r->miss, fabs(atan2(sin(off), cos(off)))); /* within half a turn */
  r->jump = fmax(r->jump, fabs(s->rocker - before->rocker) - 4 * o->rate * o->dt);
  r->deflection = fmax(r->deflection, fabs(s->deflection));
  r->balance = fmax(r->balance, fabs(s->energy - s->work));
  r->highest = fmax(r->highest, s->energy);
  r->energy_miss = fmax(r->energy_miss, fabs(s->energy - parallel_energy(l, s->rate)) / parallel_energy(l, o->rate));
}

/* file: NULL for none. The drive's work by trapezoids. */
static void run(result *r, const linkage *l, const options *o, FILE *file)
{
  static fb_system_state state;
  static fb_system_input input, middle, end;
  const int steps = (int)ceil((o->turns + 0.5) * 2 * pi / o->rate / o->dt); /* running up takes half a turn more */
  fb_link_motion start[BARS] = {{.q = {0}}};
  sample s = {0}, before;
  memset(r, 0, sizeof *r);
  build(l, o->EI);
  drive(&input, 0, o->rate);
  start[CRANK].value[0] = (fb_real)first_angle;
  start[COUPLER].value[0] = (fb_real)(coupler_angle(l, first_angle) - first_angle);
  start[ROCKER].value[0] = (fb_real)rocker_angle(l, first_angle);
  need(fb_system_state_init(&mechanism, model, &state, &work, start, &input), "initial state");
  look(&s, &state, &input);
  for (int k = 0; k < steps; k++) {
    before = s;
    drive(&middle, o->dt * (k + 0.5), o->rate);
    drive(&end, o->dt * (k + 1), o->rate);
    need(fb_system_rk4_step(&mechanism, model, &state, &work, &input, &middle, &end, (fb_real)o->dt), "step");
    input = end;
    look(&s, &state, &input);
    s.work = before.work + o->dt * (before.power + s.power) / 2;
    judge(r, l, &s, &before, o);
    if (file && k % (steps / 4000 + 1) == 0) {
      fprintf(file, "%.7g,%.10g,%.10g,%.9g,%.9g,%.6g,%.3g,%.8g,%.8g\n", o->dt * (k + 1), s.crank, s.rocker, s.x, s.y,
              s.deflection, s.gap, s.energy, s.work);
    }
  }
}

/* ---- the runs and what they must show */

static int run_to_file(result *r, const linkage *l, const options *o, const char *name)
{
  FILE *file = name ? output_open(name) : NULL;
  if (name && !file) {
    return fail("cannot write", name);
  }
  if (file) {
    fprintf(file, "t,crank,rocker,middle_x,middle_y,deflection,gap,energy,work\n");
  }
  run(r, l, o, file);
  return file ? output_close(file, name) : 0;
}

static void check_run(const linkage *l, const result *r, const options *o)
{
  const double turn = o->rate * o->dt; /* the trapezoids of the work miss by its square */
  printf("%-20s  gap %.2e m  rocker off the rigid form %.2e rad  deflection %.4f mm  energy - work %.2e of the peak\n",
         l->name, r->gap, r->miss, 1e3 * r->deflection, r->balance / r->highest);
  check("gap of the loop [m]", r->gap, FB_SINGLE ? 1e-5 : 1e-10);
  if (!l->flexible) {
    check("rocker off its closed form [rad]", r->miss, FB_SINGLE ? 1e-3 : 1e-8);
  }
  check("turn of the rocker in a step beyond four of the crank's [rad]", r->jump, 0);
  if (is_parallelogram(l)) { /* near flat its joint forces are rounding, and so is the power of the drive */
    check("energy off its closed form, of it", r->energy_miss, FB_SINGLE ? 1e-2 : 1e-4);
  } else {
    check("energy - work of the drive, of the peak", r->balance / r->highest, turn * turn + (FB_SINGLE ? 1e-2 : 1e-5));
  }
}

int main(int argc, char **argv)
{
  static const linkage linkages[] = {{"rigid coupler", {0.3, 0.9, 0.7}, 1.0, 0},
                                     {"flexible coupler", {0.3, 0.9, 0.7}, 1.0, 1},
                                     {"rigid parallelogram", {0.4, 1.0, 0.4}, 1.0, 0}};
  char name[512], svg[512];
  options o = {30, 6, 100, 1e-4, "fourbar.csv"};
  output_begin(PROGRAM);
  if (read_all(argc, argv, help, read_option, &o) != 0) {
    return 2;
  }
  other_name(name, sizeof name, o.out, "_rigid.csv");
  other_name(svg, sizeof svg, o.out, ".svg");
  for (int k = 0; k < 3; k++) {
    result r;
    if (run_to_file(&r, &linkages[k], &o, k == 0 ? name : k == 1 ? o.out : NULL)) {
      return 2;
    }
    check_run(&linkages[k], &r, &o);
  }
  plot(svg,
       "set xlabel 'x [m]'\nset ylabel 'y [m]'\nset size ratio -1\n"
       "set title 'Four-bar linkage: path of the middle of the coupler'\n",
       (const curve[]){{o.out, "4:5", "every ::1 with lines lw 2 lc rgb '#0060ad'", "flexible coupler"},
                       {name, "4:5", "every ::1 with lines lw 2 lc rgb '#dd181f'", "rigid coupler"}},
       2, stdout);
  return misses != 0;
}
