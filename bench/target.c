/* target - every stepper under random loads, on the desktop or on a board: the digest of all states, which must be the
   same wherever it runs, and the fewest and most instructions of a step, which must be the same number, but for the
   exact beam in double precision, friction and stops.
   Compile with -DBODY_HEADER, a header that reduce made, and -DBODY, the name in it; -DSTEPS (1000) of 1 ms; -DHISTOGRAM:
   below each line how many steps took how many instructions (make bench-jitter).
   sin, cos and atan2 are its own: those of C libraries differ in the
   last bit, and in the work they do. Exit: 0, 1 when a step fails or the counts differ. */
#include "../examples/firmware/board/board.h"
#define FB_SIN(x) target_sin(x)
#define FB_COS(x) target_cos(x)
#define FB_ATAN2(y, x) target_atan2(y, x)
#if FB_SINGLE
#define NUMBER float
#else
#define NUMBER double
#endif
static NUMBER target_sin(NUMBER x);
static NUMBER target_cos(NUMBER x);
static NUMBER target_atan2(NUMBER y, NUMBER x);
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"
#include BODY_HEADER

#ifndef STEPS
#define STEPS 1000
#endif

/* sin(x + quarter pi/2): pi/2 in two parts, series to x^21/21!. */
static NUMBER circular(NUMBER x, int quarter)
{
  const NUMBER scaled = x * FB_R(0.63661977236758134);
  const int turns = (int)(scaled + (scaled < FB_R(0.0) ? -FB_R(0.5) : FB_R(0.5)));
  const NUMBER y = (x - (NUMBER)turns * FB_R(1.5703125)) - (NUMBER)turns * FB_R(4.8382679489661923e-4), y2 = y * y;
  NUMBER s = FB_R(1.0), c = FB_R(1.0);
  for (int k = 20; k > 0; k -= 2) {
    s = FB_R(1.0) - y2 / (NUMBER)(k * (k + 1)) * s;
    c = FB_R(1.0) - y2 / (NUMBER)(k * (k - 1)) * c;
  }
  s = (turns + quarter) & 1 ? c : s * y;
  return (turns + quarter) & 2 ? -s : s;
}

static NUMBER target_sin(NUMBER x)
{
  return circular(x, 0);
}

static NUMBER target_cos(NUMBER x)
{
  return circular(x, 1);
}

/* The angle by halves: tan(phi/2) = y/(r + x), to an eighth, then the series to t^21/21. */
static NUMBER target_atan2(NUMBER y, NUMBER x)
{
  const NUMBER r = FB_SQRT(x * x + y * y);
  NUMBER t = y / (r + FB_FABS(x)), sum = FB_R(0.0);
  t = t / (FB_R(1.0) + FB_SQRT(FB_R(1.0) + t * t));
  t = t / (FB_R(1.0) + FB_SQRT(FB_R(1.0) + t * t));
  for (int k = 21; k > 0; k -= 2) {
    sum = FB_R(1.0) / (NUMBER)k - t * t * sum;
  }
  sum *= FB_R(8.0) * t;
  return x < FB_R(0.0) ? (y < FB_R(0.0) ? -FB_R(3.14159265358979324) : FB_R(3.14159265358979324)) - sum : sum;
}

static uint32_t seed, digest, fewest, most;
#ifdef HISTOGRAM
enum { DIFFERENT = 256 };
static uint32_t seen[DIFFERENT], times[DIFFERENT]; /* instructions, ascending; steps that took them */
static int n_seen;

static void tell(uint32_t count)
{
  int k = n_seen;
  while (k > 0 && seen[k - 1] >= count) {
    k--;
  }
  if (k < n_seen && seen[k] == count) {
    times[k]++;
  } else if (n_seen < DIFFERENT) {
    memmove(seen + k + 1, seen + k, (size_t)(n_seen - k) * sizeof seen[0]);
    memmove(times + k + 1, times + k, (size_t)(n_seen - k) * sizeof times[0]);
    seen[k] = count;
    times[k] = 1;
    n_seen++;
  }
}

static void print_seen(void)
{
  for (int k = 0; k < n_seen; k++) {
    board_print_unsigned(seen[k], 30);
    board_print_unsigned(times[k], 10);
    board_print("\n");
  }
  n_seen = 0;
}
#endif
static const fb_real dt = FB_R(0.001);

static fb_real random_number(void)
{
  seed = seed * 1664525u + 1013904223u;
  return (fb_real)((int32_t)(seed >> 8) - 8388608) / FB_R(8388608.0);
}

static void digest_reals(const fb_real *x, int n)
{
  for (int i = 0; i < n; i++) {
    uint64_t bits = 0;
#if FB_SINGLE
    uint32_t word;
    memcpy(&word, x + i, sizeof word);
    bits = word;
#else
    memcpy(&bits, x + i, sizeof bits);
#endif
    digest = board_digest(digest, bits, (int)sizeof(fb_real));
  }
}

static void begin(const char *integrator)
{
  board_print(integrator);
  seed = 1;
  digest = BOARD_DIGEST;
  fewest = 0xFFFFFFFFu;
  most = 0;
}

/* The first step of an integrator is not counted: the emulator translates its code there, and adds up to 4
   instructions that a trace does not show. */
static void counted(int step)
{
  const uint32_t count = board_count();
  if (step == 0) {
    return;
  }
  fewest = count < fewest ? count : fewest;
  most = count > most ? count : most;
#ifdef HISTOGRAM
  tell(count);
#endif
}

/* varies: the number of instructions may */
static int end(fb_status status, int step, int varies)
{
  board_print_unsigned((uint32_t)step, 9);
  board_print("  ");
  board_print_hex(digest);
  if (most > 0) {
    board_print_unsigned(fewest, 10);
    board_print_unsigned(most, 10);
  }
  board_print(status == FB_OK ? "\n" : "  ");
  if (status != FB_OK) {
    board_print(fb_status_string(status));
    board_print("\n");
  }
#ifdef HISTOGRAM
  print_seen();
#endif
  return status == FB_OK && (varies || most == 0 || most == fewest);
}

/* ---- one body */

static fb_state state;
static fb_input input[3];

static void random_load(fb_load *load, int node, fb_axes axes, fb_real size)
{
  load->node = node;
  load->axes = axes;
  for (int i = 0; i < 3; i++) {
    load->force[i] = size * random_number();
    load->torque[i] = size * random_number();
  }
}

static void body_inputs(void)
{
  input[0] = input[2];
  for (int k = 1; k < 3; k++) {
    input[k].n_load = BODY.n_node;
    for (int l = 0; l < BODY.n_node; l++) {
      random_load(&input[k].load[l], l, l % 2 ? FB_AXES_INERTIAL : FB_AXES_BODY, l ? FB_R(1.0) : FB_R(20.0));
    }
    for (int i = 0; i < 3 && BODY.base == FB_BASE_PRESCRIBED; i++) {
      input[k].w[i] = FB_R(0.1) * random_number();
      input[k].w_dot[i] = random_number();
    }
  }
}

static fb_rk4_work rk4;
static fb_implicit_work implicit;
static fb_exponential exponential;
static fb_exponential_work exponential_work;
static fb_body_work body_work;

static fb_status body_step(int integrator)
{
  switch (integrator) {
  case 0:
    return fb_rk4_step(&BODY, &state, &rk4, &input[0], &input[1], &input[2], dt);
  case 1:
    return fb_midpoint_step(&BODY, &state, &implicit, &input[1], dt, 0);
  case 2:
    return fb_sdirk_step(&BODY, &state, &implicit, &input[0], &input[2], dt, 0);
  default:
    return fb_exponential_step(&BODY, &exponential, &state, &exponential_work, &input[0], &input[1], &input[2]);
  }
}

static int run_body(const char *name, int integrator)
{
  fb_status status = fb_state_init(&BODY, &state);
  int step = 0;
  begin(name);
  status = status || integrator < 3 ? status : fb_exponential_init(&exponential, &body_work, &BODY, dt);
  memset(input, 0, sizeof input);
  body_inputs();
  while (step < STEPS && status == FB_OK) {
    body_inputs();
    board_count_start();
    status = body_step(integrator);
    counted(step);
    digest_reals(state.rho, 3);
    digest_reals(state.quat, 4);
    digest_reals(state.u, 3);
    digest_reals(state.L, 3);
    digest_reals(state.q, BODY.n);
    digest_reals(state.pi, BODY.n);
    step++;
  }
  return end(status, step, 0);
}

/* ---- a system of two: the body, free, and on its last node another one of it on a hinge with a spring */

static fb_system_desc system_desc;
static fb_system pair;
static fb_system_work system_work;
static fb_system_state system_state;
static fb_system_input system_input[3];

static void system_inputs(void)
{
  system_input[0] = system_input[2];
  for (int k = 1; k < 3; k++) {
    system_input[k].n_load = 2;
    for (int l = 0; l < 2; l++) {
      system_input[k].load[l].body = l;
      random_load(&system_input[k].load[l].load, 0, FB_AXES_BODY, FB_R(5.0));
    }
    system_input[k].drive[1 + system_desc.n_loop].torque[0] = FB_R(10.0) * random_number();
  }
}

/* loop: both booms are free, the hinge between them is a loop. rubs: the hinge has friction, and stops that it meets. */
static int run_system(const char *name, fb_method method, int loop, int rubs, int sdirk)
{
  static fb_link_motion start[2];
  const fb_node *const tip = &BODY.node[BODY.n_node - 1];
  fb_status status;
  int step = 0;
  begin(name);
  memset(&system_desc, 0, sizeof system_desc);
  memset(system_input, 0, sizeof system_input);
  system_desc.n_body = 2;
  system_desc.method = method;
  system_desc.joint[1].kind = FB_JOINT_REVOLUTE;
  system_desc.joint[1].parent_node = BODY.n_node - 1;
  system_desc.joint[1].stiffness[0] = FB_R(500.0);
  if (rubs) {
    system_desc.joint[1].friction[0] = FB_R(1.0);
    system_desc.joint[1].friction_speed[0] = FB_R(0.01);
    system_desc.joint[1].stop_stiffness[0] = FB_R(2000.0);
    system_desc.joint[1].stop_loss[0] = FB_R(0.5);
    system_desc.joint[1].stop[0][0] = -FB_R(1e-4);
    system_desc.joint[1].stop[0][1] = FB_R(1e-4);
  }
  if (loop) {
    system_desc.n_loop = 1;
    system_desc.loop[0] = system_desc.joint[1];
    system_desc.loop[0].child = 1;
    memset(&system_desc.joint[1], 0, sizeof system_desc.joint[1]);
  }
  for (int i = 0; i < 3; i++) {
    start[1].value[i] = loop ? tip->r[i] : FB_R(0.0);
  }
  system_inputs();
  status = fb_system_init(&pair, &system_work, &BODY, &system_desc, 1);
  status = status ? status : fb_system_state_init(&pair, &BODY, &system_state, &system_work, start, system_input);
  while (step < STEPS && status == FB_OK) {
    const fb_system_input *const in = system_input;
    system_inputs();
    board_count_start();
    status = sdirk ? fb_system_sdirk_step(&pair, &BODY, &system_state, &system_work, &in[0], &in[2], dt, 0)
                   : fb_system_rk4_step(&pair, &BODY, &system_state, &system_work, &in[0], &in[1], &in[2], dt);
    counted(step);
    for (int l = 0; l < 2; l++) {
      digest_reals(system_state.link[l].x, 3);
      digest_reals(system_state.link[l].quat, 4);
      digest_reals(system_state.link[l].p, 6);
      digest_reals(system_state.link[l].q, BODY.n);
      digest_reals(system_state.link[l].pi, BODY.n);
    }
    step++;
  }
  return end(status, step, rubs); /* what rubs or not, and meets a stop or not, branches */
}

/* ---- the exact beam: a clamped boom on a moving base */

static fb_exact_desc exact_desc;
static fb_exact exact;
static fb_exact_state exact_state;
static fb_exact_work exact_work;
static fb_exact_input exact_input;

static int run_exact(const char *name)
{
  fb_section section;
  fb_status status;
  int step = 0;
  begin(name);
  memset(&section, 0, sizeof section);
  memset(&exact_desc, 0, sizeof exact_desc);
  section.mass = FB_R(1.2);
  section.EA = FB_R(1e6);
  section.EI_y = section.EI_z = section.GJ = FB_R(1000.0);
  section.i_y = section.i_z = FB_R(0.01);
  exact_desc.length = FB_R(5.0);
  exact_desc.n_element = FB_MAX_EXACT;
  exact_desc.n_station = 1;
  status = fb_exact_station_init(&exact_desc.station[0], &section);
  status = status ? status : fb_exact_init(&exact, &exact_desc);
  status = status ? status : fb_exact_state_init(&exact, &exact_state, &exact_work, &exact_input);
  exact_input.n_load = 1;
  while (step < STEPS && status == FB_OK) {
    exact_input.w[2] = FB_R(0.1) * random_number();
    random_load(&exact_input.load[0], FB_MAX_EXACT, FB_AXES_INERTIAL, FB_R(10.0));
    board_count_start();
    status = fb_exact_step(&exact, &exact_state, &exact_work, &exact_input, dt);
    if (step >= 2) { /* the first two have less to extrapolate from */
      counted(step);
    }
    digest_reals(exact_state.r, 3 * (FB_MAX_EXACT + 1));
    digest_reals(exact_state.quat, 4 * (FB_MAX_EXACT + 1));
    digest_reals(exact_state.strain, 6 * FB_MAX_EXACT);
    digest_reals(exact_state.momentum, 6 * FB_MAX_EXACT);
    step++;
  }
  return end(status, step, !FB_SINGLE); /* of the exact beam at most the corrections that it is given */
}

int main(void)
{
  static const char *const names[4] = {"rk4               ", "midpoint          ", "sdirk             ",
                                       "exponential       "};
  int well = 1;
  for (int k = 0; k < 4; k++) {
    well &= run_body(names[k], k);
  }
  well &= run_system("system rk4        ", FB_METHOD_RECURSIVE, 0, 0, 0);
  well &= run_system("system dense      ", FB_METHOD_DENSE, 0, 0, 0);
  well &= run_system("system loop       ", FB_METHOD_RECURSIVE, 1, 0, 0);
  well &= run_system("system stops      ", FB_METHOD_RECURSIVE, 0, 1, 0);
  well &= run_system("system sdirk      ", FB_METHOD_RECURSIVE, 0, 0, 1);
  well &= run_exact("exact             ");
  return !well;
}
