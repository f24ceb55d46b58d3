/* page.c - the scenes of bench/case.h for a page in a browser: a modal body whose modes, effects, integrator and step
   are chosen there, and the geometrically exact beam beside it, which is the judge. The page (page.html) calls the
   functions below, compiled to WebAssembly (pack.sh); compiled for this machine the file is a program that prints the
   numbers which the page shows.
   Check of the program, with --compare yes: both models come to the same bits as by the runs of bench/case.h.
   Exit: 0 well, 1 that check failed or a model was refused, 2 bad options. */
#define _POSIX_C_SOURCE 199309L /* clock_gettime */
#define FB_MAX_EXACT 64
#define FB_MAX_NODES 20
#define FB_WITH_SYSTEM 0
#define FB_WITH_DETAIL 1
#define FLEXBEAM_IMPLEMENTATION
#include "../../flexbeam.h"
#define FBB_SAMPLES 320
#define FBB_BETWEEN 15
#include "../../bench/case.h"

enum { BODY, EXACT, MODELS, POINTS = FBB_BETWEEN + 2 }; /* POINTS: of a drawn line, from root to tip */

/* ---- what the page calls. A status is one of fb_status; `model` is BODY or EXACT. */

/* Scenes by number: their texts (0 name, 1 what happens, 2 what drives it, 3 its unit), the drive's least and largest
   value and that of bench/case.h (0, 1, 2). */
int page_scenes(void);
const char *page_text(int scene, int which);
double page_drive(int scene, int which);

/* Takes a scene with that drive, and its bending stiffness by that factor. Then its numbers: 0 duration [s], 1 length
   [m], 2 planes that it bends in (1 y, 2 z, 3 both), 3 output is the middle's, not the tip's, 4 mass [kg/m], 5 EI_y,
   6 EI_z [N m^2], 7 i_y, 8 i_z [kg m], 9 mass and 10 inertia of the hub, 11 and 12 of the payload, 13..15 gravity, 16
   fb_root, 17 fb_base, 18 spin of its modes [rad/s]. */
void page_take(int scene, double drive, double stiffness);
double page_number(int which);

/* Effects that switches stand for, by number: name ("" behind the last) and mask. Whether a set is half of something: a
   status. */
const char *page_effect_name(int effect);
unsigned page_effect_mask(int effect);
int page_effects_check(unsigned mask);
const char *page_integrator_name(int integrator); /* "" behind the last */

/* The judge: twice, the second time with both elements and steps doubled. page_judge_done: samples of both runs,
   2 page_samples() at the end. page_judge_off: estimated error of the second run, as page_error. */
int page_samples(void);
int page_judge_begin(void);
int page_judge_advance(int samples);
int page_judge_done(void);
int page_judge_elements(void); /* of the present run */
int page_judge_steps(void);    /* between samples, of the present run */
double page_judge_off(void);

/* The body: modes in each plane, step by its share of the stability limit of rk4 (1: just within). page_body_time, after
   the run: the steps of so many samples, from the start again and again, and nothing else. */
int page_body_begin(int modes, unsigned effects, int integrator, double share);
int page_body_advance(int samples);
int page_body_done(void);
int page_body_time(int samples);
int page_body_steps(void); /* between samples */

/* What was found so far, by samples: output (3 numbers [m]; bench/case.h), attitude and position of the root (4 + 3),
   line relative to it in its axes (POINTS x 3). */
const double *page_output(int model);
const double *page_pose(int model);
const double *page_line(int model);
int page_points(void);

/* Error of the output of a sample, and the largest of the first `samples`: of the largest output of the judge. */
double page_error_at(int sample);
double page_error(int samples);

const char *page_status_text(int status);
const char *page_refused_what(void); /* of the last refusal */
double page_refused_have(void);

/* ---- scenes */

typedef enum drive_kind { DRIVE_SIZE, DRIVE_SPIN, DRIVE_GRAVITY } drive_kind; /* what of an fbb_case the drive is */

typedef struct drive_range { /* beside fbb_cases */
  const char *what, *unit;
  drive_kind kind;
  double least, most;
} drive_range;

static const drive_range drives[] = {
    {"final spin", "rad/s", DRIVE_SIZE, 0, 12},           /* spin-up */
    {"spin", "rad/s", DRIVE_SPIN, 4, 40},                 /* rotor */
    {"torque", "N m", DRIVE_SIZE, 1, 60},                 /* slew */
    {"turn", "rad", DRIVE_SIZE, 0.1, 3},                  /* arm */
    {"gravity", "m/s^2", DRIVE_GRAVITY, 1, 20},           /* pendulum */
    {"acceleration of base", "m/s^2", DRIVE_SIZE, 1, 40}, /* shaken */
    {"spin", "rad/s", DRIVE_SPIN, 0.5, 8},                /* tumbling */
    {"gravity", "m/s^2", DRIVE_GRAVITY, 1, 20},           /* sag */
};
typedef char drives_are_whole[sizeof drives / sizeof drives[0] == sizeof fbb_cases / sizeof fbb_cases[0] ? 1 : -1];

static const struct {
  const char *name;
  unsigned mask;
} effects[] = {
    {"modes move", FB_EFFECT_ELASTIC},
    {"spin coupling (Coriolis)", FB_EFFECT_SPIN_COUPLING},
    {"inertia follows the shape", FB_EFFECT_RESIDUAL_INERTIA},
    {"stiffening by spin", FB_EFFECT_SPIN_STIFFENING},
    {"stiffening by acceleration", FB_EFFECT_ACCELERATION_STIFFENING},
    {"large deflection", FB_EFFECT_LARGE_DEFLECTION},
};

/* ---- what runs */

typedef struct trace {
  double output[FBB_SAMPLES][3], pose[FBB_SAMPLES][7], line[FBB_SAMPLES][POINTS][3];
  int done; /* samples */
} trace;

static struct {
  fbb_case scene;
  trace trace[MODELS]; /* EXACT: the output is that which both runs lead to, the rest of the second */
  double coarse[FBB_SAMPLES][3], fine[FBB_SAMPLES][3]; /* outputs of the judge's runs */
  int judge_done, elements, judge_steps;
  fbb_exact_flight judge;
  fb_body body;
  fbb_body_flight flight;
  fb_state start; /* of the body's run, and the input there */
  fb_input input;
  int steps; /* of the body between samples */
} page;

static double length_of(const double x[3])
{
  return sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
}

/* A sample of a model: line and pose from its points, root to tip, in inertial axes. */
static void sample_line(trace *t, int sample, fb_real x[POINTS][3], const fb_real quat[4])
{
  fb_real R[9];
  fb_quat_to_mat33(R, quat);
  for (int i = 0; i < 4; i++) {
    t->pose[sample][i] = (double)quat[i];
  }
  for (int i = 0; i < 3; i++) {
    t->pose[sample][4 + i] = (double)x[0][i];
  }
  for (int p = 0; p < POINTS; p++) {
    fb_real d[3], y[3];
    for (int i = 0; i < 3; i++) {
      d[i] = x[p][i] - x[0][i];
    }
    fb_mat33_mulT_vec3(y, R, d);
    for (int i = 0; i < 3; i++) {
      t->line[sample][p][i] = (double)y[i];
    }
  }
}

static fb_status sample_body(int sample)
{
  static const fb_motion rest; /* positions want no velocities */
  trace *const t = &page.trace[BODY];
  fb_real end[FBB_NODES][3], quat[FBB_NODES][4], x[POINTS][3];
  fb_node_motion node;
  fb_status status = FB_OK;
  for (int j = 0; j < FBB_NODES + FBB_BETWEEN && status == FB_OK; j++) { /* root, middle, tip, then those between */
    status = fb_body_node_motion_eval(&page.body, &node, &page.flight.state, &rest, j + 1);
    if (j < FBB_NODES) {
      memcpy(end[j], node.position, sizeof end[j]);
      memcpy(quat[j], node.quat, sizeof quat[j]);
    } else {
      memcpy(x[j - FBB_NODES + 1], node.position, sizeof x[0]);
    }
  }
  if (status == FB_OK) {
    memcpy(x[0], end[FBB_ROOT], sizeof x[0]);
    memcpy(x[POINTS - 1], end[FBB_TIP], sizeof x[0]);
    fbb_output(t->output[sample], &page.scene, end, quat);
    sample_line(t, sample, x, quat[FBB_ROOT]);
    t->done = sample + 1;
  }
  return status;
}

static void sample_judge(int sample)
{
  trace *const t = &page.trace[EXACT];
  fb_real x[POINTS][3];
  fbb_exact_output(page.fine[sample], &page.judge, &page.scene);
  fbb_extrapolate_row(t->output[sample], page.coarse[sample], page.fine[sample]);
  for (int p = 0; p < POINTS; p++) {
    memcpy(x[p], page.judge.node[p * page.elements / (POINTS - 1)].position, sizeof x[p]);
  }
  sample_line(t, sample, x, page.judge.node[0].quat);
  t->done = sample + 1;
}

/* ---- the functions of the page */

int page_scenes(void)
{
  return FBB_COUNT(fbb_cases);
}

const char *page_text(int scene, int which)
{
  const char *const text[] = {fbb_cases[scene].name, fbb_cases[scene].what, drives[scene].what, drives[scene].unit};
  return text[which];
}

double page_drive(int scene, int which)
{
  const drive_range *const d = &drives[scene];
  const fbb_case *const c = &fbb_cases[scene];
  const double usual = d->kind == DRIVE_SIZE ? c->size : length_of(d->kind == DRIVE_SPIN ? c->spin : c->gravity);
  return which == 0 ? d->least : which == 1 ? d->most : usual;
}

void page_take(int scene, double drive, double stiffness)
{
  const double by = drive / page_drive(scene, 2);
  fbb_case *const c = &page.scene;
  *c = fbb_cases[scene];
  c->EI_y *= stiffness;
  c->EI_z *= stiffness;
  if (drives[scene].kind == DRIVE_SIZE) {
    c->size = drive;
  }
  for (int i = 0; i < 3 && drives[scene].kind == DRIVE_SPIN; i++) {
    c->spin[i] *= by;
  }
  for (int i = 0; i < 3 && drives[scene].kind == DRIVE_GRAVITY; i++) {
    c->gravity[i] *= by;
  }
  if (c->steady) { /* the load is once per turn */
    c->period /= by;
  }
}

double page_number(int which)
{
  const fbb_case *const c = &page.scene;
  const double number[] = {c->duration,
                           c->length,
                           c->y + 2 * c->z,
                           c->chord,
                           c->mass,
                           c->EI_y,
                           c->EI_z,
                           c->i_y,
                           c->i_z,
                           c->hub_mass,
                           c->hub_inertia,
                           c->payload_mass,
                           c->payload_inertia,
                           c->gravity[0],
                           c->gravity[1],
                           c->gravity[2],
                           (double)c->root,
                           (double)c->base,
                           c->steady ? c->spin[2] : 0};
  return number[which];
}

const char *page_effect_name(int effect)
{
  return effect < FBB_COUNT(effects) ? effects[effect].name : "";
}

unsigned page_effect_mask(int effect)
{
  return effects[effect].mask;
}

int page_effects_check(unsigned mask)
{
  return fb_effects_check(mask);
}

const char *page_integrator_name(int integrator)
{
  return integrator < (int)FB_INTEGRATOR_COUNT ? stepper_name[integrator] : "";
}

int page_samples(void)
{
  return FBB_SAMPLES;
}

/* Elements and steps of the coarser run are those of bench/case.h, whose steps are between 160 samples, but at most 32. */
int page_judge_begin(void)
{
  const fbb_case *const c = &page.scene;
  page.judge_done = page.trace[EXACT].done = 0;
  page.elements = c->elements ? c->elements : 16;
  page.judge_steps = (c->steps > 32 ? 32 : c->steps ? c->steps : 8) * 160 / FBB_SAMPLES;
  return fbb_exact_begin(&page.judge, c, page.elements, page.judge_steps);
}

int page_judge_advance(int samples)
{
  fb_status status = FB_OK;
  for (int k = 0; k < samples && page.judge_done < 2 * FBB_SAMPLES && status == FB_OK; k++) {
    if (page.judge_done == FBB_SAMPLES) {
      page.elements *= 2;
      page.judge_steps *= 2;
      status = fbb_exact_begin(&page.judge, &page.scene, page.elements, page.judge_steps);
    }
    status = status ? status : fbb_exact_advance(&page.judge, &page.scene, page.judge_steps);
    if (status == FB_OK && page.judge_done < FBB_SAMPLES) {
      fbb_exact_output(page.coarse[page.judge_done], &page.judge, &page.scene);
    } else if (status == FB_OK) {
      sample_judge(page.judge_done - FBB_SAMPLES);
    }
    page.judge_done += status == FB_OK;
  }
  return status;
}

int page_judge_done(void)
{
  return page.judge_done;
}

int page_judge_elements(void)
{
  return page.elements;
}

int page_judge_steps(void)
{
  return page.judge_steps;
}

int page_body_begin(int modes, unsigned mask, int integrator, double share)
{
  static fb_shape shape;
  static fb_body_work work;
  const fbb_case *const c = &page.scene;
  const fbb_basis basis = fbb_modes_of(c, c->y * modes, c->z * modes);
  const double sample = c->duration / FBB_SAMPLES;
  double limit;
  fb_body_desc desc;
  fb_status status;
  page.trace[BODY].done = page.steps = 0;
  fbb_shape_make(&shape, c, &basis);
  fbb_body_desc_make(&desc, c, mask | (fbb_has_gravity(c) ? (unsigned)FB_EFFECT_GRAVITY : 0u));
  desc.allow_split_effects = 1; /* half an effect is worse than none: to be seen */
  status = fb_body_init(&page.body, &work, &shape, &desc);
  if (status != FB_OK) {
    return status;
  }
  limit = share * (double)fb_rk4_limit(&page.body, (fb_real)fbb_largest_spin(c), 0);
  page.steps = limit < sample ? (int)ceil(sample / limit) : 1;
  status = fbb_body_begin(&page.flight, c, &page.body, (fb_integrator)integrator, page.steps);
  page.start = page.flight.state;
  page.input = page.flight.input[2];
  return status;
}

int page_body_advance(int samples)
{
  fb_status status = FB_OK;
  for (int k = 0; k < samples && page.trace[BODY].done < FBB_SAMPLES && status == FB_OK; k++) {
    status = fbb_body_advance(&page.flight, &page.scene, page.steps);
    status = status ? status : sample_body(page.trace[BODY].done);
  }
  return status;
}

int page_body_time(int samples)
{
  fb_status status = FB_OK;
  for (int k = 0; k < samples && status == FB_OK; k++) {
    if (page.flight.step >= FBB_SAMPLES * page.steps) {
      page.flight.state = page.start;
      page.flight.input[2] = page.input;
      page.flight.step = 0;
    }
    status = fbb_body_advance(&page.flight, &page.scene, page.steps);
  }
  return status;
}

int page_body_done(void)
{
  return page.trace[BODY].done;
}

int page_body_steps(void)
{
  return page.steps;
}

const double *page_output(int model)
{
  return page.trace[model].output[0];
}

const double *page_pose(int model)
{
  return page.trace[model].pose[0];
}

const double *page_line(int model)
{
  return page.trace[model].line[0][0];
}

int page_points(void)
{
  return POINTS;
}

/* The largest output of the judge, so far. */
static double judge_size(void)
{
  double size = 0;
  for (int k = 0; k < page.trace[EXACT].done; k++) {
    size = fmax(size, length_of(page.trace[EXACT].output[k]));
  }
  return size;
}

/* Distance of two outputs. */
static double distance(const double a[3], const double b[3])
{
  const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return length_of(d);
}

double page_error_at(int sample)
{
  const double size = judge_size();
  return size > 0 ? distance(page.trace[BODY].output[sample], page.trace[EXACT].output[sample]) / size : 0;
}

double page_error(int samples)
{
  const double size = judge_size();
  double most = 0;
  for (int k = 0; k < samples; k++) {
    most = fmax(most, distance(page.trace[BODY].output[k], page.trace[EXACT].output[k]));
  }
  return size > 0 ? most / size : 0;
}

double page_judge_off(void)
{
  const double size = judge_size();
  double most = 0;
  for (int k = 0; k < page.trace[EXACT].done; k++) {
    most = fmax(most, distance(page.coarse[k], page.fine[k]) / 3);
  }
  return size > 0 ? most / size : 0;
}

const char *page_status_text(int status)
{
  return fb_status_string((fb_status)status);
}

const char *page_refused_what(void)
{
  return fb_detail_last()->what;
}

double page_refused_have(void)
{
  return (double)fb_detail_last()->have;
}

/* ---- the program */

#ifndef __wasm__
#define PROGRAM "page"
#include "../common/options.h"
#include "../common/output.h"

typedef struct options {
  double scene, drive, stiffness, modes, effects, share; /* drive: 0 as in bench/case.h */
  int integrator, compare;
} options;

static const char help[] =
    "page - the numbers of a scene that build/page/flexbeam.html shows: a modal body beside the exact beam\n"
    "usage: page [options]\n"
    "  --scene N         0 spin-up, 1 rotor, 2 slew, 3 arm, 4 pendulum, 5 shaken, 6 tumbling, 7 sag (0)\n"
    "  --drive X         its drive: spin, torque, turn, gravity or acceleration in SI units (0: as usual)\n"
    "  --stiffness F     factor of the bending stiffness, 0.1 to 10 (1)\n"
    "  --modes N         modes in each plane, 1 to 6 (3)\n"
    "  --effects MASK    of fb_effect, as one number (31: FB_EFFECTS_FULL)\n"
    "  --integrator NAME rk4, midpoint, sdirk or exponential (rk4)\n"
    "  --step S          share of the stability limit of rk4, 0.05 to 16 (1)\n"
    "  --compare yes|no  with the runs of bench/case.h (yes)\n"
    "  --help            this text\n"
    "It prints JSON: statuses, steps, errors by the largest output, output [m] of both models by samples.\n";

static int read_option(void *target, const char *name, const char *text)
{
  options *const o = target;
  const number_option numbers[] = {{"--scene", &o->scene, 0, FBB_COUNT(fbb_cases) - 1},
                                   {"--drive", &o->drive, 0, 1000},
                                   {"--stiffness", &o->stiffness, 0.1, 10},
                                   {"--modes", &o->modes, 1, 6},
                                   {"--effects", &o->effects, 0, 511},
                                   {"--step", &o->share, 0.05, 16}};
  if (strcmp(name, "--integrator") == 0) {
    return read_choice(&o->integrator, name, text, "rk4|midpoint|sdirk|exponential");
  }
  if (strcmp(name, "--compare") == 0) {
    return read_choice(&o->compare, name, text, "no|yes");
  }
  return read_number(numbers, FBB_COUNT(numbers), name, text);
}

static void print_output(const char *name, const trace *t)
{
  printf(", \"%s\": [", name);
  for (int k = 0; k < 3 * t->done; k++) {
    printf("%s%.17g", k ? ", " : "", t->output[k / 3][k % 3]);
  }
  printf("]");
}

/* Whether the runs of bench/case.h come to the same bits. */
static int is_as_in_case(int integrator)
{
  static fbb_history history, here;
  memcpy(here.out, page.trace[BODY].output, sizeof here.out);
  fbb_body_run(&history, &page.scene, &page.body, (fb_integrator)integrator, page.steps);
  if (history.status != FB_OK || fbb_difference(&history, &here) != 0) {
    return 0;
  }
  memcpy(here.out, page.fine, sizeof here.out);
  fbb_exact_run(&history, &page.scene, page.elements, page.judge_steps);
  return history.status == FB_OK && fbb_difference(&history, &here) == 0;
}

int main(int argc, char **argv)
{
  options o = {0, 0, 1, 3, FB_EFFECTS_FULL, 1, FB_INTEGRATOR_RK4, 1};
  int body, judge, bad;
  output_begin(PROGRAM);
  bad = read_all(argc, argv, help, read_option, &o);
  if (bad) {
    return bad;
  }
  page_take((int)o.scene, o.drive > 0 ? o.drive : page_drive((int)o.scene, 2), o.stiffness);
  judge = page_judge_begin();
  judge = judge ? judge : page_judge_advance(2 * page_samples());
  body = page_body_begin((int)o.modes, (unsigned)o.effects, o.integrator, o.share);
  body = body ? body : page_body_advance(page_samples());
  printf("{\"scene\": \"%s\", \"body\": \"%s\", \"judge\": \"%s\", \"steps\": %d", page_text((int)o.scene, 0),
         page_status_text(body), page_status_text(judge), page_body_steps());
  printf(", \"error\": %.17g, \"off\": %.17g", page_error(page_body_done()), page_judge_off());
  print_output("body_output", &page.trace[BODY]);
  print_output("exact_output", &page.trace[EXACT]);
  printf("}\n");
  if (o.compare && body == FB_OK && judge == FB_OK && !is_as_in_case(o.integrator)) {
    fprintf(stderr, PROGRAM ": the runs of bench/case.h come to other bits\n");
    return 1;
  }
  return 0;
}
#endif
