/* fourbar - a four-bar linkage whose coupler bends: a closed loop of crank, coupler and rocker.
   The tree is ground - crank - coupler and ground - rocker; a further revolute joint between the tips of coupler and
   rocker closes the loop. A prescribed angle turns the crank, from rest up to a steady rate. Three runs: the rigid
   linkage, whose rocker has a closed form; the same with a flexible coupler; and a rigid parallelogram, which goes flat
   twice a turn, where the loop alone does not say how it moves on: its momentum does.
   Exit: 0 well, 1 a check failed or the motion left the model, 2 bad options. */
#define _POSIX_C_SOURCE 200809L /* popen, for gnuplot */
#define FB_MAX_BODIES 3
#define FB_MAX_LOOPS 1
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#define PROGRAM "fourbar"
#include "common/options.h"
#include "common/output.h"
#include "common/plot.h"

enum { CRANK, COUPLER, ROCKER, BARS };
enum { TIP = 1, MIDDLE = 2 }; /* nodes of a bar */
static const double pi = 3.14159265358979324;

typedef struct linkage {
  const char *name;
  double length[BARS], ground; /* [m] */
  int flexible;
} linkage;

typedef struct options {
  double rate, turns, EI, dt; /* [rad/s], of the crank, [N m^2] of the coupler, [s] */
  const char *coupler, *out;
} options;

static const char help[] =
    "fourbar - a four-bar linkage with a rigid and with a flexible coupler, and a parallelogram\n"
    "usage: fourbar [options]\n"
    "  --rate W      [rad/s] of the crank when it is up to speed, 1 to 40 (30)\n"
    "  --turns N     of the crank, 2 to 100 (6)\n"
    "  --ei EI       [N m^2] bending stiffness of the coupler (100)\n"
    "  --dt DT       [s] step, at most 1e-3 (1e-4)\n"
    "  --coupler rigid|flexible|both  (both; rigid runs the parallelogram, too)\n"
    "  --out FILE    CSV of the flexible linkage (fourbar.csv); the rigid one beside it as _rigid.csv, the path of "
    "the\n"
    "                coupler's middle as picture\n"
    "  --help        this text\n"
    "CSV: t [s], angles of crank and rocker [rad], middle of the coupler x, y [m], its deflection [m], gap of the loop "
    "[m],\n"
    "energy and work of the drive [J].\n"
    "The bounds of the checks are those of the defaults: faster cranks, longer steps and softer couplers may miss "
    "them\n"
    "and say so (exit 1); a coupler that bends too far, or a step beyond its limit, stops the run.\n";

static int read_option(void *target, const char *name, const char *text)
{
  options *const o = target;
  const number_option numbers[] = {{"--rate", &o->rate, 1, 40},
                                   {"--turns", &o->turns, 2, 100},
                                   {"--ei", &o->EI, 1, 1e6},
                                   {"--dt", &o->dt, 1e-6, 1e-3}};
  if (strcmp(name, "--out") == 0) {
    return read_out(&o->out, text);
  }
  if (strcmp(name, "--coupler") == 0) {
    const int known = !strcmp(text, "rigid") || !strcmp(text, "flexible") || !strcmp(text, "both");
    o->coupler = text;
    return known ? 0 : fail("--coupler wants rigid, flexible or both", text);
  }
  return read_number(numbers, 4, name, text);
}

/* ---- model: bars along x, 1 kg/m; all joints turn about z */

static fb_body model[BARS];
static fb_system mechanism;
static fb_system_work work;
static fb_system_motion motion;

/* The coupler bends in the plane. Its root is a pin: the frame takes its rigid turns, the modes none of them. */
static fb_status build_bar(fb_body *body, double length, double EI)
{
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_shape shape;
  static fb_body_work body_work;
  fb_beam_desc desc;
  fb_modes_desc keep;
  fb_body_desc level;
  int node;
  fb_status status;
  memset(&desc, 0, sizeof desc);
  memset(&keep, 0, sizeof keep);
  memset(&level, 0, sizeof level);
  desc.length = (fb_real)length;
  desc.n_element = 6;
  desc.root = FB_ROOT_PINNED; /* modes of a clamped one would leave the pin next to no inertia to turn */
  desc.n_station = 1;
  desc.station[0].mass = 1;
  desc.station[0].i_z = FB_R(1e-4);
  desc.station[0].EI_z = (fb_real)EI;
  keep.count[FB_KIND_BEND_Y] = 3;
  keep.n_load = 1; /* the pull of the loop */
  keep.load[0].node = desc.n_element;
  keep.load[0].axis = 1;
  level.effects = EI > 0 ? FB_EFFECTS_FULL : FB_EFFECTS_RIGID;
  level.base = FB_BASE_PRESCRIBED; /* a slender bar has no inertia about its axis */
  status = fb_beam_init(&beam, &desc);
  if (EI > 0) {
    status = status ? status : fb_modes_solve(&modes, &modes_work, &beam, &keep);
    status = status ? status : fb_shape_init(&shape, modes.n);
    status = status ? status : fb_shape_add_beam(&shape, 0, &beam, &modes);
    status = status ? status : fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, desc.length);
    status = status ? status : fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, desc.length / 2);
  } else {
    const fb_real tip[3] = {desc.length, 0, 0}, middle[3] = {desc.length / 2, 0, 0};
    const fb_real J = desc.length * desc.length * desc.length / 12, inertia[6] = {0, J, J, 0, 0, 0};
    status = status ? status : fb_shape_init(&shape, 0);
    status = status ? status : fb_shape_add_rigid(&shape, desc.length, middle, inertia);
    status = status ? status : fb_shape_add_node(&shape, &node, tip, NULL, NULL);
    status = status ? status : fb_shape_add_node(&shape, &node, middle, NULL, NULL);
  }
  return status ? status : fb_body_init(body, &body_work, &shape, &level);
}

static fb_status build(const linkage *l, double EI)
{
  static fb_system_desc desc;
  fb_status status = FB_OK;
  memset(&desc, 0, sizeof desc);
  desc.n_body = BARS;
  for (int k = 0; k < BARS && status == FB_OK; k++) {
    status = build_bar(&model[k], l->length[k], k == COUPLER && l->flexible ? EI : 0);
    desc.model[k] = k;
    desc.joint[k].kind = FB_JOINT_REVOLUTE;
    desc.joint[k].parent = k == COUPLER ? CRANK : FB_GROUND;
    desc.joint[k].parent_node = k == COUPLER ? TIP : 0;
  }
  desc.joint[CRANK].mode[0] = FB_AXIS_PRESCRIBED;
  desc.joint[ROCKER].position[0] = (fb_real)l->ground;
  desc.n_loop = 1;
  desc.loop[0].kind = FB_JOINT_REVOLUTE;
  desc.loop[0].parent = COUPLER;
  desc.loop[0].parent_node = TIP;
  desc.loop[0].child = ROCKER;
  desc.loop[0].child_node = TIP;
  return status ? status : fb_system_init(&mechanism, &work, model, &desc, BARS);
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
  if (is_parallelogram(l)) {
    return crank;
  }
  return atan2(y, x) - acos((e * e + c * c - b * b) / (2 * e * c));
}

static double coupler_angle(const linkage *l, double crank)
{
  const double r = rocker_angle(l, crank);
  return atan2(l->length[ROCKER] * sin(r) - l->length[CRANK] * sin(crank),
               l->ground + l->length[ROCKER] * cos(r) - l->length[CRANK] * cos(crank));
}

/* a less b, within half a turn */
static double turned(double a, double b)
{
  return atan2(sin(a - b), cos(a - b));
}

/* ---- one run */

typedef struct result {
  fb_status status;
  double t_stop;           /* [s] */
  double gap;              /* [m] largest of the loop */
  double miss;             /* [rad] largest of the rocker from its closed form */
  double jump;             /* [rad] largest turn of the rocker in a step beyond what the crank's rate allows */
  double deflection;       /* [m] largest of the coupler's middle off its chord */
  double balance, highest; /* [J] largest |energy - work|, largest energy */
  double energy_miss;      /* of a parallelogram: from its closed form, of the energy at full rate */
} result;

typedef struct sample {
  double crank, rate, rocker; /* [rad], [rad/s], [rad] */
  double middle[2];           /* [m] */
  double deflection, gap;     /* [m] */
  double energy, work, power; /* [J], [J], [W] */
} sample;

static const double first_angle = 0.5; /* [rad] of the crank */

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

static fb_status start(fb_system_state *state, const linkage *l, const fb_system_input *input)
{
  static fb_link_motion at[BARS];
  at[CRANK].value[0] = (fb_real)first_angle;
  at[COUPLER].value[0] = (fb_real)(coupler_angle(l, first_angle) - first_angle);
  at[ROCKER].value[0] = (fb_real)rocker_angle(l, first_angle);
  return fb_system_state_init(&mechanism, model, state, &work, at, input);
}

static fb_status look(sample *s, const fb_system_state *state, const fb_system_input *input)
{
  fb_node_motion tip = {0}, middle = {0}, other = {0};
  fb_energy e = {0, 0, 0};
  fb_status status = fb_system_motion_eval(&mechanism, model, &work, &motion, state, input);
  const fb_state *pose = motion.pose;
  const fb_motion *m = motion.motion;
  status = status ? status : fb_body_node_motion_eval(&model[COUPLER], &tip, &pose[COUPLER], &m[COUPLER], TIP);
  status = status ? status : fb_body_node_motion_eval(&model[COUPLER], &middle, &pose[COUPLER], &m[COUPLER], MIDDLE);
  status = status ? status : fb_body_node_motion_eval(&model[ROCKER], &other, &pose[ROCKER], &m[ROCKER], TIP);
  status = status ? status : fb_system_energy_eval(&mechanism, model, &work, &e, state, input);
  s->gap = 0;
  for (int i = 0; i < 3; i++) {
    s->gap = fmax(s->gap, fabs((double)(tip.position[i] - other.position[i])));
  }
  s->crank = (double)input->drive[CRANK].value[0];
  s->rate = (double)input->drive[CRANK].rate[0];
  s->rocker = (double)state->link[ROCKER].x[0];
  s->middle[0] = (double)middle.position[0];
  s->middle[1] = (double)middle.position[1];
  s->deflection = (double)(middle.displacement[1] - tip.displacement[1] / 2);
  s->energy = (double)(e.kinetic + e.strain);
  s->power = (double)motion.power;
  return status;
}

/* Kinetic energy of a parallelogram: crank and rocker turn, the coupler moves along a circle without turning. */
static double parallel_energy(const linkage *l, double rate)
{
  const double a = l->length[CRANK];
  return (a * a * a / 3 + l->length[COUPLER] * a * a / 2) * rate * rate;
}

static void judge(result *r, const linkage *l, const sample *s, const sample *before, const options *o)
{
  const double allowed = 4 * o->rate * o->dt, full = parallel_energy(l, o->rate);
  r->gap = fmax(r->gap, s->gap);
  r->miss = fmax(r->miss, fabs(turned(s->rocker, rocker_angle(l, s->crank))));
  r->jump = fmax(r->jump, fabs(s->rocker - before->rocker) - allowed);
  r->deflection = fmax(r->deflection, fabs(s->deflection));
  r->balance = fmax(r->balance, fabs(s->energy - s->work));
  r->highest = fmax(r->highest, s->energy);
  r->energy_miss = fmax(r->energy_miss, fabs(s->energy - parallel_energy(l, s->rate)) / full);
}

static void write_row(FILE *file, double t, const sample *s)
{
  fprintf(file, "%.7g,%.10g,%.10g,%.9g,%.9g,%.6g,%.3g,%.8g,%.8g\n", t, s->crank, s->rocker, s->middle[0], s->middle[1],
          s->deflection, s->gap, s->energy, s->work);
}

/* file: NULL for none. The drive's work by trapezoids. */
static void run(result *r, const linkage *l, const options *o, FILE *file)
{
  static fb_system_state state;
  static fb_system_input input, middle, end;
  const int steps = (int)ceil((o->turns + 0.5) * 2 * pi / o->rate / o->dt); /* running up takes half a turn more */
  const int every = steps / 4000 + 1;
  sample s, before;
  memset(r, 0, sizeof *r);
  memset(&s, 0, sizeof s);
  drive(&input, 0, o->rate);
  r->status = build(l, o->EI);
  r->status = r->status ? r->status : start(&state, l, &input);
  r->status = r->status ? r->status : look(&s, &state, &input);
  if (file) {
    fprintf(file, "t,crank,rocker,middle_x,middle_y,deflection,gap,energy,work\n");
  }
  for (int k = 0; k < steps && r->status == FB_OK; k++) {
    before = s;
    drive(&middle, o->dt * (k + 0.5), o->rate);
    drive(&end, o->dt * (k + 1), o->rate);
    r->status = fb_system_rk4_step(&mechanism, model, &state, &work, &input, &middle, &end, (fb_real)o->dt);
    r->t_stop = o->dt * (k + 1);
    input = end;
    r->status = r->status ? r->status : look(&s, &state, &input);
    if (r->status == FB_OK) {
      s.work = before.work + o->dt * (before.power + s.power) / 2;
      judge(r, l, &s, &before, o);
      if (file && k % every == 0) {
        write_row(file, r->t_stop, &s);
      }
    }
  }
}

/* ---- the runs and what they must show */

static int run_to_file(result *r, const linkage *l, const options *o, const char *name)
{
  FILE *file = name ? fopen(name, "w") : NULL;
  if (name && !file) {
    return fail("cannot write", name);
  }
  run(r, l, o, file);
  if (file && output_close(file, name)) {
    return 2;
  }
  if (r->status != FB_OK) {
    printf("%s stopped at %.4f s: %s (joint %d)\n", l->name, r->t_stop, fb_status_string(r->status), work.joint);
    return 1;
  }
  printf("%-20s  gap %.2e m  rocker off the rigid form %.2e rad  deflection %.4f mm  energy - work %.2e of the peak\n",
         l->name, r->gap, r->miss, 1e3 * r->deflection, r->balance / r->highest);
  return 0;
}

static int check(const char *name, const char *what, double value, double bound)
{
  const int ok = value <= bound;
  printf("check: %s, %s: %.3g, at most %.3g: %s\n", name, what, value, bound, ok ? "ok" : "FAILED");
  return ok;
}

static int check_run(const linkage *l, const result *r, const options *o)
{
  const double turn = o->rate * o->dt; /* the trapezoids of the work miss by its square */
  int ok = check(l->name, "gap of the loop [m]", r->gap, FB_SINGLE ? 1e-5 : 1e-10);
  if (!l->flexible) {
    ok &= check(l->name, "rocker off its closed form [rad]", r->miss, FB_SINGLE ? 1e-3 : 1e-8);
  }
  ok &= check(l->name, "turn of the rocker in a step beyond four of the crank's [rad]", r->jump, 0);
  if (is_parallelogram(l)) { /* near flat its joint forces are rounding, and so is the power of the drive */
    return ok & check(l->name, "energy off its closed form, of it", r->energy_miss, FB_SINGLE ? 1e-2 : 1e-4);
  }
  return ok & check(l->name, "energy - work of the drive, of the peak", r->balance / r->highest,
                    turn * turn + (FB_SINGLE ? 1e-2 : 1e-5));
}

static void draw(const char *svg, const char *rigid, const char *flexible)
{
  const curve curves[] = {{flexible, "4:5", "every ::1 with lines lw 2 lc rgb '#0060ad'", "flexible coupler"},
                          {rigid, "4:5", "every ::1 with lines lw 2 lc rgb '#dd181f'", "rigid coupler"}};
  const int first = flexible ? 0 : 1;
  plot(svg,
       "set xlabel 'x [m]'\nset ylabel 'y [m]'\nset size ratio -1\nset title 'Four-bar linkage: path of the middle of "
       "the coupler'\n",
       curves + first, (rigid != NULL) + (flexible != NULL), stdout);
}

int main(int argc, char **argv)
{
  static const linkage linkages[] = {{"rigid coupler", {0.3, 0.9, 0.7}, 1.0, 0},
                                     {"flexible coupler", {0.3, 0.9, 0.7}, 1.0, 1},
                                     {"rigid parallelogram", {0.4, 1.0, 0.4}, 1.0, 0}};
  static char name[512], svg[512];
  options o = {30, 6, 100, 1e-4, "both", "fourbar.csv"};
  int status, ok = 1;
  output_begin(PROGRAM);
  status = read_all(argc, argv, help, read_option, &o);
  if (status != 0) {
    return status;
  }
  other_name(name, sizeof name, o.out, "_rigid.csv");
  other_name(svg, sizeof svg, o.out, ".svg");
  for (int k = 0; k < 3; k++) {
    result r;
    if (strcmp(o.coupler, "both") != 0 && linkages[k].flexible != (strcmp(o.coupler, "flexible") == 0)) {
      continue;
    }
    status = run_to_file(&r, &linkages[k], &o, k == 0 ? name : k == 1 ? o.out : NULL);
    if (status == 2) {
      return status;
    }
    ok &= status == 0 && check_run(&linkages[k], &r, &o);
  }
  draw(svg, strcmp(o.coupler, "flexible") == 0 ? NULL : name, strcmp(o.coupler, "rigid") == 0 ? NULL : o.out);
  return ok ? 0 : 1;
}
