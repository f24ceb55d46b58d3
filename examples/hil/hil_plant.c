/* hil_plant - a spacecraft in real time, for a controller in another process: hub, three reaction wheels and two
   flexible arrays on drives are stepped at 1 kHz; sensors go out and commands come in as packets (hil.h) over UDP on
   the loopback address. hil_controller is its partner: start it before or after, `make hil` starts both.
   Every period, at an instant counted from the first: the commands that have come are read, the sensors of this instant
   are sent, the step to the next one is made. A command thus acts a period after the sensors it answers.
   Both have the same key (hil_key.h): what is not signed by it, or comes a second time or late, is refused and counted.
   Safe command, when no valid command has come for the time of the watchdog, and before the first one: no torque on the
   wheels, the drives' motors short-circuited, which damps the arrays. The next valid command ends it.
   Lateness has a budget (--late-ms): a period that begins or ends later than that is no real time any more, the safe
   command is given and the run ends. Within it the plant catches up, and a command acts no longer than the watchdog
   lets. In lock-step (--simulated-time) the plant waits for the answer instead of the clock: the same packets, the same
   bits each time. With `direct` the controller is a function call and no packet is sent: again the same bits.
   Checks: no step that computes longer than the period; the hub within 0.01 degrees of its aim in the last 5 s of a run
   long enough for that; angular momentum as it was; at the end a controller that commands.
   Exit: 0 well, 1 a check failed, no controller came, the plant was too late, or the motion left the model, 2 bad
   options, a port or a file that cannot be had. */
#define _POSIX_C_SOURCE 200809L /* sockets, clocks, popen */
#define FLEXBEAM_IMPLEMENTATION
#include "../../flexbeam.h"
#define PROGRAM "hil_plant"
#include "../common/clock.h"
#include "../firmware/board/board.h"
#include "hil_link.h"
#include "hil_line.h"
#include "../common/options.h"
#include "../common/output.h"
#include "hil_key.h"
#include "../common/plot.h"
#include "../common/solar_array.h"
#include "hil_control.h"

enum { HUB, WHEEL, RIGHT = WHEEL + 3, LEFT, BODIES }; /* of the system */
enum { HUB_MODEL, WHEEL_MODEL, ARRAY_MODEL, MODELS }; /* wheels share one, arrays too */
enum { MOST_ROWS = 6000, MOST_SUSPECTS = 64, REPEATS = 5 };
static const double degree = 3.14159265358979324 / 180;

typedef struct options {
  double seconds, rate, port, watchdog, late, patience, priority; /* [s], [Hz], -, [ms], [ms], [s], - */
  int pace;
  const char *out, *key;
} options;

static const char help[] =
    "hil_plant - a flexible spacecraft in real time, commanded by packets on the loopback address\n"
    "usage: hil_plant [options]\n"
    "  --seconds T      [s] of the run (60); the manoeuvre takes 22, pointing is judged from 52 on\n"
    "  --rate F         [Hz] of steps and packets, 100 to 10000 (1000)\n"
    "  --port P         UDP port on 127.0.0.1, 0: one that is free (47800)\n"
    "  --key FILE       32 hexadecimal digits that the controller has, too (the variable HIL_KEY, or else hil.key,\n"
    "                   which is made if it is not there)\n"
    "  --watchdog-ms T  [ms] without a valid command, then the safe command acts (100)\n"
    "  --late-ms T      [ms] that a period may be late in real time; then the safe command acts, and the run ends "
    "with\n"
    "                   exit 1 (100)\n"
    "  --simulated-time no|lock-step|direct  no: real time; lock-step: as fast as the answers come; direct: the\n"
    "                   controller is called, no packets (no)\n"
    "  --patience T     [s] lock-step only: so long an answer is waited for, then the controller is silent (10)\n"
    "  --priority P     of SCHED_FIFO in real time, 0: do not ask for it (50)\n"
    "  --out FILE       CSV of the run; beside it pictures (SVG) when gnuplot is there (hil.csv)\n"
    "  --help           this text\n"
    "CSV: t [s], pointing error [deg], tips' deflection [m], wheel torques [N m], wheel speeds [rad/s], drive angles\n"
    "[rad], gauges, safe, age of the command [periods]; in real time the longest since the row before of: delay of "
    "the\n"
    "wake-up, time of computation, time to the end of the step [us].\n";

static int read_option(void *target, const char *name, const char *text)
{
  options *const o = target;
  const number_option numbers[] = {{"--seconds", &o->seconds, 0.01, 36000}, {"--rate", &o->rate, 100, 10000},
                                   {"--port", &o->port, 0, 65535},          {"--watchdog-ms", &o->watchdog, 1, 1e5},
                                   {"--late-ms", &o->late, 0.1, 1e6},       {"--patience", &o->patience, 0.01, 1e4},
                                   {"--priority", &o->priority, 0, 99}};
  if (strcmp(name, "--simulated-time") == 0) {
    return read_choice(&o->pace, name, text, "no|lock-step|direct");
  }
  if (strcmp(name, "--out") == 0) {
    return read_out(&o->out, text);
  }
  if (strcmp(name, "--key") == 0) {
    o->key = text;
    return 0;
  }
  return read_number(numbers, (int)(sizeof numbers / sizeof numbers[0]), name, text);
}

static int read_options(options *o, int argc, char **argv)
{
  const int status = read_all(argc, argv, help, read_option, o);
  if (status != 0) {
    return status;
  }
  if (o->port != floor(o->port) || o->priority != floor(o->priority)) {
    return fail("--port and --priority are whole numbers", "");
  }
  return o->seconds * o->rate <= 4e6 ? 0 : fail("--seconds times --rate is at most 4000000", "");
}

/* ---- the model */

static fb_beam beam;
static fb_modes modes;
static fb_body model[MODELS];
static fb_system craft;
static fb_system_work work;
static fb_gauge gauge;
static int tip, imu_node; /* of an array, of the hub */

/* A rigid body about its own center. */
static fb_status make_rigid(fb_body *body, int *node, double mass, const double J[3], const double at[3])
{
  static fb_shape shape;
  static fb_body_work scratch;
  const fb_body_desc rigid = {.base = FB_BASE_PRESCRIBED};
  const fb_real center[3] = {0}, none[1] = {0}, r[3] = {(fb_real)at[0], (fb_real)at[1], (fb_real)at[2]};
  const fb_real inertia[6] = {(fb_real)J[0], (fb_real)J[1], (fb_real)J[2], 0, 0, 0};
  fb_status status = fb_shape_init(&shape, 0);
  status = status ? status : fb_shape_add_rigid(&shape, (fb_real)mass, center, inertia);
  status = status ? status : fb_shape_add_node(&shape, node, r, none, none);
  return status ? status : fb_body_init(body, &scratch, &shape, &rigid);
}

/* z of a wheel's joint along axis i of the hub. */
static void hang_wheel(fb_joint_desc *joint, int i)
{
  const fb_real h = (fb_real)sqrt(0.5);
  const fb_real attitude[3][4] = {{h, 0, h, 0}, {h, -h, 0, 0}, {1, 0, 0, 0}};
  joint->kind = FB_JOINT_REVOLUTE;
  joint->parent = HUB;
  joint->position[i] = (fb_real)wheel_place;
  joint->damping[0] = (fb_real)wheel_friction;
  memcpy(joint->attitude, attitude[i], sizeof attitude[i]);
}

static fb_status make_craft(void)
{
  static fb_system_desc desc;
  const double wheel[3] = {wheel_transverse, wheel_transverse, wheel_inertia};
  const double imu[3] = {0.2, 0.1, -0.3}, origin[3] = {0}; /* [m] */
  int unused;
  fb_status status = make_rigid(&model[HUB_MODEL], &imu_node, hub_mass, hub_inertia, imu);
  status = status ? status : make_rigid(&model[WHEEL_MODEL], &unused, wheel_mass, wheel, origin);
  status = status ? status : solar_array_init(&model[ARRAY_MODEL], &tip, &beam, &modes, &arrays);
  status = status ? status : fb_gauge_init(&gauge, 0, &beam, &modes, FB_R(0.05), 0, FB_R(0.02));
  desc.n_body = BODIES;
  desc.model[HUB] = HUB_MODEL;
  desc.joint[HUB].kind = FB_JOINT_FREE;
  desc.joint[HUB].parent = FB_GROUND;
  for (int i = 0; i < 3; i++) {
    desc.model[WHEEL + i] = WHEEL_MODEL;
    hang_wheel(&desc.joint[WHEEL + i], i);
  }
  for (int k = RIGHT; k <= LEFT; k++) {
    desc.model[k] = ARRAY_MODEL;
    solar_array_hang(&desc.joint[k], &arrays, k == RIGHT ? 1 : -1);
    desc.joint[k].damping[0] = (fb_real)drive_friction;
  }
  return status ? status : fb_system_init(&craft, &work, model, &desc, MODELS);
}

/* ---- the plant: state, sensors, a period */

typedef struct plant {
  fb_system_state state;
  fb_system_input input;
  fb_system_motion motion;
  double period;   /* [s] */
  int steps;       /* of rk4 in a period */
  long star_every; /* periods between readings of the star tracker */
  uint32_t noise, digest;
  double momentum[3];                /* [N m s] at the beginning */
  double sensors[HIL_SENSOR_VALUES]; /* of the present instant */
} plant;

/* Uniform in (-size, size), repeatable. */
static double random_number(plant *p, double size)
{
  p->noise = p->noise * 1664525u + 1013904223u;
  return size * ((double)(p->noise >> 8) / 8388608.0 - 1);
}

/* Encoders of 20 bits. */
static double encoder(fb_real angle)
{
  const double count = 2 * 3.14159265358979324 / 1048576;
  return count * floor((double)angle / count + 0.5);
}

/* Gyros with a bias, accelerometers, a star tracker every 0.1 s, wheel tachometers, encoders, strain gauges. */
static fb_status sense(plant *p, long k)
{
  static const double bias[3] = {2e-5, -1e-5, 1.5e-5}; /* [rad/s] */
  double *const s = p->sensors;
  fb_node_motion node;
  fb_imu imu;
  fb_status status = fb_system_motion_eval(&craft, model, &work, &p->motion, &p->state, &p->input);
  status = status ? status
                  : fb_body_node_motion_eval(&model[HUB_MODEL], &node, &p->motion.pose[HUB], &p->motion.motion[HUB],
                                             imu_node);
  if (status != FB_OK) {
    return status;
  }
  fb_imu_eval(&imu, &node, NULL);
  for (int i = 0; i < 3; i++) {
    s[HIL_GYRO + i] = (double)imu.angular_rate[i] + bias[i] + random_number(p, 2e-5);
    s[HIL_FORCE + i] = (double)imu.specific_force[i] + random_number(p, 1e-4);
    s[HIL_WHEEL + i] = (double)p->motion.joint[WHEEL + i].speed[0];
  }
  s[HIL_STAR_NEW] = k % p->star_every == 0;
  for (int i = 0; i < 4 && k % p->star_every == 0; i++) {
    s[HIL_STAR + i] = (double)node.quat[i] + random_number(p, 1e-5);
  }
  for (int i = 0; i < 2; i++) {
    s[HIL_DRIVE + i] = encoder(p->state.link[RIGHT + i].x[0]);
    s[HIL_STRAIN + i] = (double)fb_gauge_eval(&gauge, p->motion.pose[RIGHT + i].q) + random_number(p, 1e-7);
  }
  s[HIL_PERIOD] = p->period;
  return FB_OK;
}

static fb_status plant_begin(plant *p, const options *o)
{
  static fb_link_motion start[BODIES];
  fb_momentum m = {{0}, {0}};
  fb_status status;
  double limit;
  memset(p, 0, sizeof *p);
  p->period = 1 / o->rate;
  p->star_every = lround(0.1 * o->rate);
  p->noise = 1;
  p->digest = BOARD_DIGEST;
  for (int i = 0; i < 3; i++) {
    start[WHEEL + i].speed[0] = (fb_real)wheel_start;
  }
  limit = 0.5 * (double)fb_system_rk4_limit(&craft, model, 0, 0);
  p->steps = (int)ceil(p->period / limit);
  status = fb_system_state_init(&craft, model, &p->state, &work, start, &p->input);
  status = status ? status : fb_system_momentum_eval(&craft, model, &work, &m, &p->state, &p->input);
  for (int i = 0; i < 3; i++) {
    p->momentum[i] = (double)m.angular[i];
  }
  return status ? status : sense(p, 0);
}

/* The command as torques; NULL: the safe one, drives braked by speed as by a short-circuited motor. */
static void plant_command(plant *p, const double *command)
{
  static const double brake = 2; /* [N m s] */
  for (int i = 0; i < 3; i++) {
    p->input.drive[WHEEL + i].torque[0] = command ? (fb_real)command[HIL_WHEEL_TORQUE + i] : 0;
  }
  for (int i = 0; i < 2; i++) {
    p->input.drive[RIGHT + i].torque[0] = command ? (fb_real)command[HIL_DRIVE_TORQUE + i]
                                                  : (fb_real)(-brake * (double)p->motion.joint[RIGHT + i].speed[0]);
  }
}

static void digest(plant *p, const fb_real *x, int n)
{
  for (int i = 0; i < n; i++) {
    const double value = (double)x[i];
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    p->digest = board_digest(p->digest, bits, 8);
  }
}

/* From instant k to the next one. */
static fb_status plant_step(plant *p, long k)
{
  fb_status status = FB_OK;
  for (int i = 0; i < p->steps && status == FB_OK; i++) {
    status = fb_system_rk4_step(&craft, model, &p->state, &work, &p->input, &p->input, &p->input,
                                (fb_real)(p->period / p->steps));
  }
  for (int b = 0; b < BODIES; b++) {
    const fb_link_state *l = &p->state.link[b];
    digest(p, l->x, 3);
    digest(p, l->quat, 4);
    digest(p, l->p, 6);
    digest(p, l->q, model[craft.model[b]].n);
    digest(p, l->pi, model[craft.model[b]].n);
  }
  return status ? status : sense(p, k + 1);
}

/* [rad] between the hub and its aim */
static double pointing_error(const plant *p, double t)
{
  fb_real wanted[4];
  double error[3];
  wanted_attitude(wanted, t);
  turn_between(error, wanted, p->state.link[HUB].quat);
  return sqrt(error[0] * error[0] + error[1] * error[1] + error[2] * error[2]);
}

static double tip_deflection(const plant *p, int body)
{
  fb_node_motion at;
  const fb_status status =
      fb_body_node_motion_eval(&model[ARRAY_MODEL], &at, &p->motion.pose[body], &p->motion.motion[body], tip);
  return status == FB_OK ? (double)at.displacement[2] : (double)NAN;
}

/* ---- time */

static void interrupt(int signal)
{
  (void)signal;
  interrupted = 1;
}

static double cpu_ns(void)
{
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static void sleep_until(double ns)
{
  struct timespec t;
  t.tv_sec = (time_t)floor(ns / 1e9);
  t.tv_nsec = (long)(ns - 1e9 * (double)t.tv_sec);
  while (!interrupted && clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, NULL) == EINTR) {
  }
}

/* ---- a run and its record */

enum { /* columns of the CSV */
       TIME,
       ERROR,
       TIPS,
       TORQUES = TIPS + 2,
       SPEEDS = TORQUES + 3,
       ANGLES = SPEEDS + 3,
       STRAINS = ANGLES + 2,
       SAFE = STRAINS + 2,
       AGE,
       LATE,
       COMPUTED,
       FINISHED,
       COLUMNS
};
static const char columns[] = "t,error_deg,tip_right,tip_left,torque_x,torque_y,torque_z,speed_x,speed_y,speed_z,"
                              "angle_right,angle_left,strain_right,strain_left,safe,age,late_us,computed_us,end_us";

typedef struct suspect { /* a step that seemed to compute longer than the period */
  plant before;
  long k;
  double computed; /* [ns] */
} suspect;

typedef struct record {
  long periods, done, stride, rows;
  double row[MOST_ROWS + 1][COLUMNS]; /* and the one of a run that ends too late */
  double *late, *computed, *end; /* [us] wake-up after its instant, time of the processor, end of the step after it */
  double *age;                   /* [periods] of the commands that acted */
  int ages;
  double worst[3]; /* [us] of the first three, since the last row */
  long by_computation, by_scheduler, suspects;
  suspect suspect[MOST_SUSPECTS]; /* those that took longest */
  double longest_repeated;        /* [us] */
} record;

/* All memory that the run takes; NULL: there is not so much. */
static record *record_begin(const options *o)
{
  static record r;
  r.periods = lround(o->seconds * o->rate);
  r.stride = 1 + r.periods / MOST_ROWS;
  r.late = calloc(4 * (size_t)r.periods, sizeof r.late[0]);
  if (!r.late) {
    return NULL;
  }
  r.computed = r.late + r.periods;
  r.end = r.computed + r.periods;
  r.age = r.end + r.periods;
  return &r;
}

static void record_row(record *r, const plant *p, const line *l, long k)
{
  double *x = r->row[r->rows++];
  x[TIME] = (double)k * p->period;
  x[ERROR] = pointing_error(p, x[TIME]) / degree;
  for (int i = 0; i < 3; i++) {
    x[TORQUES + i] = (double)p->input.drive[WHEEL + i].torque[0];
    x[SPEEDS + i] = (double)p->motion.joint[WHEEL + i].speed[0];
  }
  for (int i = 0; i < 2; i++) {
    x[TIPS + i] = tip_deflection(p, RIGHT + i);
    x[ANGLES + i] = (double)p->state.link[RIGHT + i].x[0];
    x[STRAINS + i] = p->sensors[HIL_STRAIN + i];
  }
  x[SAFE] = l->safe;
  x[AGE] = l->safe ? 0 : r->age[r->ages - 1];
  memcpy(&x[LATE], r->worst, sizeof r->worst);
  memset(r->worst, 0, sizeof r->worst);
}

/* Where there is no room the one goes that took the shortest time. */
static void record_suspect(record *r, const plant *before, long k, double computed)
{
  suspect *place = r->suspect;
  for (long i = 1; i < MOST_SUSPECTS && r->suspects >= MOST_SUSPECTS; i++) {
    place = r->suspect[i].computed < place->computed ? &r->suspect[i] : place;
  }
  if (r->suspects < MOST_SUSPECTS) {
    place = &r->suspect[r->suspects];
  }
  if (r->suspects++ < MOST_SUSPECTS || place->computed < computed) {
    place->before = *before;
    place->k = k;
    place->computed = computed;
  }
}

/* What the period cost, in real time [ns]. A deadline was missed by the scheduler if the processor did not work that
   long: it woke the plant late or took the processor away. If it did, the step is suspect. */
static void record_time(record *r, const plant *before, long k, double release, double woke, double computed)
{
  const double end = clock_ns() - release, period = 1e9 * before->period;
  const double us[3] = {(woke - release) / 1e3, computed / 1e3, end / 1e3};
  if (computed > period) {
    record_suspect(r, before, k, computed);
  } else {
    r->by_scheduler += end > period;
  }
  r->late[k] = us[0];
  r->computed[k] = us[1];
  r->end[k] = us[2];
  for (int i = 0; i < 3; i++) {
    r->worst[i] = fmax(r->worst[i], us[i]);
  }
}

static long suspects_tried(const record *r)
{
  return r->suspects < MOST_SUSPECTS ? r->suspects : MOST_SUSPECTS;
}

/* After the run: a suspect step is made again, several times from the same state. It does the same work, so the
   shortest time is its own; what it took longer before was taken from it by what a process cannot see, as on a virtual
   machine. To be acquitted it must leave room for what else a period does, at most the median of all that periods
   took. */
static void try_suspects(record *r)
{
  static plant again;
  const long tried = suspects_tried(r);
  const double typical = tried > 0 ? 1e3 * clock_timing_of(r->computed, (int)r->done).median : 0; /* [ns] */
  for (long i = 0; i < tried; i++) {
    double shortest = HUGE_VAL;
    for (int n = 0; n < REPEATS; n++) {
      double start;
      again = r->suspect[i].before;
      start = cpu_ns();
      (void)plant_step(&again, r->suspect[i].k); /* it went well before */
      shortest = fmin(shortest, cpu_ns() - start);
    }
    r->longest_repeated = fmax(r->longest_repeated, shortest / 1e3);
    *(shortest + typical > 1e9 * again.period ? &r->by_computation : &r->by_scheduler) += 1;
  }
}

/* What acts in this period, and what the sensors say at its beginning; called directly, the controller answers here. */
static void exchange(plant *p, line *l, record *r, controller *direct, long k)
{
  const double t = (double)k * p->period;
  watch(l, t);
  if (!l->safe) {
    r->age[r->ages++] = (double)(uint32_t)(l->sequence - l->answered + 1);
  }
  p->sensors[HIL_SAFE] = l->safe;
  plant_command(p, l->safe ? NULL : l->command);
  if (direct) {
    controller_step(direct, l->command, t, p->sensors);
    l->answered = ++l->sequence;
    l->fresh = 1;
  } else {
    send_packet(l, HIL_SENSORS, t, p->sensors);
  }
}

/* Is a period later than the budget? Then the safe command is given, and the last row says so. */
static int is_too_late(plant *p, line *l, record *r, const options *o, double late)
{
  const double t = (double)r->done * p->period;
  if (late <= 1e6 * o->late) {
    return 0;
  }
  fprintf(stderr, "hil_plant: at %.3f s: %.1f ms late, the budget is %g ms (--late-ms): safe command, the run ends\n",
          t, late / 1e6, o->late);
  note(l, t, "too late: safe command");
  l->safe = 1;
  plant_command(p, NULL);
  record_row(r, p, l, r->done);
  return 1;
}

/* One period; 0: no controller came, it was too late, or the motion left the model. */
static int fly_period(plant *p, line *l, record *r, controller *direct, const options *o, double release)
{
  static plant before;
  const long k = r->done;
  double woke = 0, worked = 0;
  fb_status status;
  if (o->pace == REAL_TIME) {
    sleep_until(release);
    woke = clock_ns();
    worked = cpu_ns();
    if (!interrupted && is_too_late(p, l, r, o, woke - release)) {
      return 0;
    }
    receive(l);
  } else if (o->pace == LOCK_STEP && !await_answer(l, o->patience)) {
    fprintf(stderr, "hil_plant: no controller came back\n");
    return 0;
  }
  exchange(p, l, r, direct, k);
  if (k % r->stride == 0) {
    record_row(r, p, l, k);
  }
  before = *p;
  status = plant_step(p, k);
  if (status != FB_OK) {
    fprintf(stderr, "hil_plant: after %g s: %s\n", (double)k * p->period, fb_status_string(status));
    return 0;
  }
  if (o->pace == REAL_TIME) {
    record_time(r, &before, k, release, woke, cpu_ns() - worked);
  }
  r->done++;
  return o->pace != REAL_TIME || !is_too_late(p, l, r, o, clock_ns() - release - 1e9 * p->period);
}

/* The whole run; 0 as above. An interrupt ends it early, its report is that of what was flown. */
static int fly(plant *p, line *l, record *r, controller *direct, const options *o)
{
  const double none[1] = {0};
  double start;
  int well = 1;
  if (!direct) {
    printf("hil_plant: waits %d s for a controller\n", (int)PARTNER_PATIENCE);
    fflush(stdout);
    if (!await_partner(l)) {
      fprintf(stderr, "hil_plant: no controller came\n");
      return 0;
    }
    printf("hil_plant: a controller has come\n");
    fflush(stdout);
  }
  start = clock_ns() + 1e7;
  while (well && r->done < r->periods && !interrupted) {
    well = fly_period(p, l, r, direct, o, start + (double)r->done * 1e9 * p->period);
  }
  for (int k = 0; k < 3 && !direct; k++) { /* a packet may get lost */
    send_packet(l, HIL_END, (double)r->done * p->period, none);
  }
  return well;
}

/* ---- results */

static void write_csv(FILE *file, const record *r)
{
  fprintf(file, "%s\n", columns);
  for (long k = 0; k < r->rows; k++) {
    for (int i = 0; i < COLUMNS; i++) {
      fprintf(file, "%.10g%s", r->row[k][i], i + 1 < COLUMNS ? "," : "\n");
    }
  }
}

static void draw(const char *csv, int real_time)
{
  char svg[512];
  const curve pointing[] = {{csv, "1:2", "every ::1 with lines lw 2 lc rgb '#0060ad'", "pointing error [deg]"},
                            {csv, "1:(abs($3))", "every ::1 with lines lw 1 lc rgb '#dd181f'", "right tip [m]"}};
  const curve times[] = {{csv, "1:19", "every ::1 with dots lc rgb '#888888'", "end of the step"},
                         {csv, "1:17", "every ::1 with dots lc rgb '#dd181f'", "wake-up"},
                         {csv, "1:18", "every ::1 with lines lw 1 lc rgb '#0060ad'", "computation"}};
  other_name(svg, sizeof svg, csv, "_pointing.svg");
  plot(svg,
       "set logscale y\nset format y '10^{%L}'\nset yrange [1e-7:]\n"
       "set title 'Hardware in the loop: pointing error, deflection of an array'\n",
       pointing, 2, stdout);
  if (real_time) {
    other_name(svg, sizeof svg, csv, "_time.svg");
    plot(svg,
         "set logscale y\nset ylabel 'longest of some periods [us]'\n"
         "set title 'Hardware in the loop: time after the instant at which a period begins'\n",
         times, 3, stdout);
  }
}

static void print_timing(const char *what, double *sample, long n)
{
  const clock_timing t = clock_timing_of(sample, (int)n);
  printf("  %-42s %9.1f %9.1f %9.1f %9.1f\n", what, t.lowest, t.median, t.p99, t.highest);
}

static void report(record *r, const plant *p, const line *l, const options *o)
{
  static const char *const paces[] = {"real time", "lock-step", "controller called directly"};
  printf("%ld periods of %g ms, %d step%s of rk4 each, %d bodies with %d elastic coordinates: %s\n", r->done,
         1e3 * p->period, p->steps, p->steps > 1 ? "s" : "", (int)BODIES, 2 * modes.n, paces[o->pace]);
  printf("  %-42s %9s %9s %9s %9s\n", "", "min", "median", "p99", "max");
  if (o->pace == REAL_TIME && r->done > 0) {
    print_timing("wake-up after its instant [us]", r->late, r->done);
    print_timing("computation, time of the processor [us]", r->computed, r->done);
    print_timing("end of the step after that instant [us]", r->end, r->done);
  }
  if (r->ages > 0) {
    print_timing("age of the command that acts [periods]", r->age, r->ages);
  }
  if (o->pace == REAL_TIME) {
    printf("  missed deadlines: %ld by the computation, %ld by the scheduler\n", r->by_computation, r->by_scheduler);
  }
  if (r->suspects > 0) {
    printf(
        "  %ld steps seemed to compute longer than the period; the longest %ld, repeated after the run, take at most "
        "%.1f us\n",
        r->suspects, suspects_tried(r), r->longest_repeated);
  }
  if (o->pace != DIRECT) {
    const hil_traffic *t = &l->traffic;
    printf("  packets: %ld sent, %ld unsent, %ld received, %ld lost, %ld refused\n", t->sent, t->unsent, t->received,
           t->lost, hil_refused(t));
    print_refusals(t);
  }
  printf("  watchdog of %g ms: %ld trips, %ld recoveries\n", o->watchdog, l->trips, l->recoveries);
  for (int k = 0; k < l->n_event && k < MOST_EVENTS; k++) {
    printf("  %10.3f s  %s\n", l->events[k].time, l->events[k].what);
  }
  if (l->n_event > MOST_EVENTS) {
    printf("  %d more events\n", l->n_event - MOST_EVENTS);
  }
  printf("  digest of all states: %08lx\n", (unsigned long)p->digest);
}

static int failures;

static void check(const char *what, double got, double bound)
{
  printf("  %-54s %10.3g  at most %8.3g  %s\n", what, got, bound, got <= bound ? "ok" : "FAILED");
  failures += !(got <= bound);
}

static void judge(const record *r, const plant *p, const line *l)
{
  const double end = (double)r->done * p->period;
  fb_momentum m = {{0}, {0}};
  double miss = 0, error = 0;
  const fb_status status = fb_system_momentum_eval(&craft, model, &work, &m, &p->state, &p->input);
  for (int i = 0; i < 3; i++) {
    miss = fmax(miss, fabs((double)m.angular[i] - p->momentum[i]) / (wheel_inertia * wheel_start));
  }
  check("steps that compute longer than the period", (double)r->by_computation, 0);
  check("angular momentum, change per wheel's at the beginning", status == FB_OK ? miss : (double)NAN,
        FB_SINGLE ? 1e-5 : 1e-12);
  check("safe command at the end", l->safe, 0);
  if (end < slew_start + slew_time + settling_time + 5) {
    printf("  pointing is not judged: the run ends before the hub can have settled\n");
    return;
  }
  for (long k = 0; k < r->rows; k++) {
    error = r->row[k][TIME] > end - 5 ? fmax(error, r->row[k][ERROR]) : 0;
  }
  check("pointing error in the last 5 s [deg]", error, pointing_bound / degree);
}

int main(int argc, char **argv)
{
  static plant p;
  static line l;
  static controller direct;
  options o = {60, 1000, 47800, 100, 100, 10, 50, REAL_TIME, "hil.csv", NULL};
  hil_key key = {{0}}, seed = {{0}};
  struct sigaction on_interrupt;
  record *r;
  FILE *out;
  fb_status status;
  int well, port, link = -1;
  int bad;
  output_begin(PROGRAM);
  bad = read_options(&o, argc, argv);
  if (bad) {
    return bad;
  }
  if ((o.pace != DIRECT || o.key) && key_read(&key, o.key)) {
    return 2;
  }
  if (!key_random(seed.byte, sizeof seed.byte)) {
    return fail("cannot have random numbers", "/dev/urandom");
  }
  r = record_begin(&o);
  port = (int)o.port;
  link = o.pace == DIRECT ? 0 : link_open(&port);
  if (!r || link < 0) {
    return fail(r ? "cannot have the port" : "cannot have the memory", strerror(errno));
  }
  status = make_craft();
  status = status ? status : plant_begin(&p, &o);
  status = status ? status : controller_init(&direct);
  if (status != FB_OK) {
    fprintf(stderr, "hil_plant: %s\n", fb_status_string(status));
    return 1;
  }
  out = output_open(o.out); /* before the run: a minute of it is not lost to a wrong name */
  if (!out) {
    return fail("cannot write", o.out);
  }
  line_init(&l, link, &key, &seed, (long)ceil(o.watchdog * 1e-3 * o.rate));
  memset(&on_interrupt, 0, sizeof on_interrupt);
  on_interrupt.sa_handler = interrupt;
  sigaction(SIGINT, &on_interrupt, NULL);
  sigaction(SIGTERM, &on_interrupt, NULL);
  if (o.pace != DIRECT) {
    printf("hil_plant: 127.0.0.1, port %d\n", port);
  }
  if (o.pace == REAL_TIME) {
    ask_for_real_time("hil_plant", (int)o.priority);
  }
  fflush(stdout);
  well = fly(&p, &l, r, o.pace == DIRECT ? &direct : NULL, &o);
  leave_real_time();
  if (r->done == 0) { /* nothing to report */
    output_drop(out, o.out);
    free(r->late);
    return 1;
  }
  write_csv(out, r);
  if (output_close(out, o.out)) {
    return 2;
  }
  printf("curves: %s\n", o.out);
  fflush(stdout);
  draw(o.out, o.pace == REAL_TIME);
  try_suspects(r);
  report(r, &p, &l, &o);
  judge(r, &p, &l);
  free(r->late);
  return well && failures == 0 ? 0 : 1;
}
