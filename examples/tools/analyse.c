/* analyse - what a body does about a steady spin: deflection, complex modes, stability margin, steps.
   The body is one of those flexbeam reduce reads; its base is free, pinned, hinged or prescribed as the file says.
   Exit: 0 well, 1 it cannot be analyzed, 2 bad options or input. */
#define _POSIX_C_SOURCE 200809L
#include "capacities.h"
#include "../../flexbeam.h"
#include "model.h"
#define PROGRAM "analyse"
#include "../common/options.h"
#include "words.h"
#include "../common/linear_out.h"
#include "../common/same_file.h"
#include "../common/spectrum.h"
#include "ports.h"

static const char help[] =
    "analyse - steady spin of a body from a text file, and the motion about it\n"
    "usage: flexbeam analyse [FILE] [options]\n"
    "  FILE              description (examples/satellite.txt; words: examples/tools/README.md)\n"
    "  --spin X,Y,Z|Z    steady spin [rad/s], body axes; one value: about z (0)\n"
    "  --rpm X,Y,Z|Z     the same [rpm]\n"
    "  --modes N         modes that are printed, 1 to 12 (8)\n"
    "  --tolerance E     error wanted of every mode of amplitude 1, by all of them together (0.001)\n"
    "  --duration T      over this time [s] (60)\n"
    "  --linear FILE     A, B, C, D about the steady spin, with names and units: FILE.json, or CSV\n"
    "  --inputs LIST     of it, with commas between: force.NODE.AXIS, torque.NODE.AXIS, of a prescribed base\n"
    "                    base_velocity.AXIS, base_rate.AXIS; motor.ROTOR; NODE, ROTOR a name or a number, AXIS x, y "
    "or z\n"
    "                    (force at the last node, torque at node 0)\n"
    "  --outputs LIST    displacement, rotation, rate, acceleration, each .NODE.AXIS; rotor_speed.ROTOR\n"
    "                    (displacement of the last node, rate of node 0)\n"
    "  --help            this text\n"
    "A free or pinned body spins about the principal axis of its deformed shape nearest to the one wanted, a hinged "
    "one\n"
    "about z; rigid motion is among the modes. A free body falls with its gravity, which is left out. Steps are those\n"
    "advised, and no longer than the steppers accept at that spin. Rotors turn at the speeds of the description, held "
    "by\ntheir motors against friction. Modes over the spin: a scene with this body, and scene --campbell.\n";

typedef struct options {
  const char *file, *linear, *inputs, *outputs;
  double spin[3], modes, tolerance, duration;
} options;

static fb_analyse_work work;
static fb_spectrum spectrum;
static fb_state state;
static fb_input input;

static int read_option(void *to, const char *name, const char *text)
{
  options *o = (options *)to;
  const number_option list[] = {{"--modes", &o->modes, 1, 12},
                                {"--tolerance", &o->tolerance, 1e-15, 10},
                                {"--duration", &o->duration, 1e-9, 1e12}};
  if (strcmp(name, "--spin") == 0 || strcmp(name, "--rpm") == 0) {
    const int status = read_vector(o->spin, name, text);
    for (int i = 0; i < 3; i++) {
      o->spin[i] *= name[2] == 's' ? 1 : 2 * model_pi / 60;
    }
    return status;
  }
  if (strcmp(name, "--linear") == 0 && (text[0] == 0 || strlen(text) >= 400)) {
    return fail("--linear wants a file name of less than 400 characters", "");
  }
  for (int k = 0; k < 3; k++) {
    const struct {
      const char *name, **text;
    } texts[] = {{"--linear", &o->linear}, {"--inputs", &o->inputs}, {"--outputs", &o->outputs}};
    if (strcmp(name, texts[k].name) == 0) {
      *texts[k].text = text;
      return 0;
    }
  }
  return read_number(list, (int)(sizeof list / sizeof *list), name, text);
}

/* The torque of a motor that holds its rotor at its speed against friction. */
static fb_real hold(const fb_rotor *rotor, fb_real speed)
{
  const fb_real slip = FB_SQRT(speed * speed + rotor->friction_speed * rotor->friction_speed);
  return speed * (rotor->damping + (rotor->friction > FB_R(0.0) ? rotor->friction / slip : FB_R(0.0)));
}

/* Steady state with the rotors at their speeds relative to their nodes: their momenta depend on the spin that a free
   body finds with them. Friction, which motors balance, is left out of the search. */
static fb_status trim_rotors(void)
{
  static fb_body smooth;
  fb_motion motion;
  const fb_real exact = FB_R(4e4) * FB_EPSILON;
  fb_real most = FB_SQRT(fb_vec3_dot(input.w, input.w)), miss = FB_HUGE;
  fb_status status = FB_OK;
  smooth = model_body;
  for (int k = 0; k < smooth.n_rotor; k++) {
    fb_rotor *const rotor = &smooth.rotor[k];
    const fb_real speed = (fb_real)model.rotor[k].text.speed + fb_vec3_dot(rotor->axis, input.w);
    rotor->damping = rotor->friction = FB_R(0.0);
    input.rotor[k].torque = FB_R(0.0);
    input.rotor[k].momentum = (fb_real)model.rotor[k].momentum;
    state.pi[smooth.n + k] = rotor->given ? input.rotor[k].momentum : rotor->inertia * speed;
    most = FB_FABS(speed) > most ? FB_FABS(speed) : most;
  }
  for (int round = 0; round < 20 && status == FB_OK && miss > exact * most; round++) {
    status = fb_body_trim(&smooth, &state, &work, &input);
    status = status ? status : fb_body_motion_eval(&smooth, &motion, &state, &input);
    miss = FB_R(0.0);
    for (int k = 0; k < smooth.n_rotor && status == FB_OK; k++) {
      const fb_real off =
          smooth.rotor[k].given ? FB_R(0.0) : (fb_real)model.rotor[k].text.speed - motion.rotor_speed[k];
      state.pi[smooth.n + k] += smooth.rotor[k].inertia * off;
      miss = FB_FABS(off) > miss ? FB_FABS(off) : miss;
    }
  }
  status = status == FB_OK && miss > exact * most ? FB_ERR_CONVERGENCE : status;
  for (int k = 0; k < smooth.n_rotor && status == FB_OK; k++) {
    input.rotor[k].torque = model_body.rotor[k].given ? FB_R(0.0) : hold(&model_body.rotor[k], motion.rotor_speed[k]);
  }
  return status;
}

/* Steady state and spectrum at a spin along an axis; state goes on from the last one. */
static fb_status solve(const double axis[3], double spin)
{
  fb_status status;
  for (int i = 0; i < 3; i++) {
    input.w[i] = (fb_real)(spin * axis[i]);
  }
  status = model_body.n_rotor > 0 ? trim_rotors() : fb_body_trim(&model_body, &state, &work, &input);
  status = status ? status : fb_body_spectrum_solve(&model_body, &work, &spectrum, &state, &input);
  if (status == FB_OK) {
    (void)spectrum_drop_rounding(spectrum.re, spectrum.im, spectrum.n);
  }
  return status;
}

static int fail_at(double spin, fb_status status)
{
  fprintf(stderr, PROGRAM ": at %.6g rad/s: %s\n", spin,
          status == FB_ERR_VALUE && model_body.base == FB_BASE_HINGED ? "a hinged base turns about z alone"
                                                                      : refusal_text(status));
  return 1;
}

/* Where the body takes an axis of its own it is said. */
static void print_spin(const fb_motion *motion)
{
  double spin = 0, turn = 0;
  for (int i = 0; i < 3; i++) {
    spin = hypot(spin, (double)motion->w[i]);
    turn = hypot(turn, (double)(motion->w[i] - input.w[i]));
  }
  if (turn > 1e-3 * spin) {
    printf("it spins at %.6g rad/s about (%.4g, %.4g, %.4g), %s\n", spin, (double)motion->w[0] / spin,
           (double)motion->w[1] / spin, (double)motion->w[2] / spin,
           model_body.n_rotor > 0 ? "about which it is steady with its rotors" : "the principal axis nearest to that");
  }
}

/* Seen from a base that spins, gravity across its axis turns: there is no steady state. */
static void print_gravity(void)
{
  fb_real across[3];
  fb_vec3_cross(across, model_body.gravity, input.w);
  if ((model_body.effects & FB_EFFECT_GRAVITY) && fb_vec3_dot(across, across) > FB_R(0.0)) {
    printf("gravity is not along the axis: what follows is for it standing still in the turning frame\n");
  }
}

static void print_rotors(const fb_motion *motion)
{
  for (int k = 0; k < model_body.n_rotor; k++) {
    printf("  rotor %s: %.6g rad/s, momentum %.6g N m s, motor %.4g N m\n", model.rotor[k].text.name,
           (double)motion->rotor_speed[k], (double)motion->rotor_momentum[k], (double)input.rotor[k].torque);
  }
}

static void print_trim(void)
{
  fb_motion motion;
  fb_status status = fb_body_motion_eval(&model_body, &motion, &state, &input);
  if (status == FB_OK) {
    print_spin(&motion);
    print_gravity();
  }
  printf("steady deflection: elastic coordinates");
  for (int a = 0; a < model_body.n; a++) {
    printf(" %.4g", (double)state.q[a]);
  }
  printf("\n");
  for (int node = 1; node < model_body.n_node && status == FB_OK; node++) {
    fb_node_motion at;
    status = fb_body_node_motion_eval(&model_body, &at, &state, &motion, node);
    if (status == FB_OK) {
      printf("  node %d: displacement %.6g %.6g %.6g m\n", node, (double)at.displacement[0], (double)at.displacement[1],
             (double)at.displacement[2]);
    }
  }
  if (status == FB_OK) {
    print_rotors(&motion);
  }
}

static void print_modes(int count)
{
  int worst;
  const double margin = (double)fb_spectrum_margin(&worst, spectrum.re, spectrum.n) + 0.0; /* no -0 */
  printf("mode     re [1/s]   im [rad/s]          Hz     damping\n");
  for (int k = 0; k < spectrum.n && k < count; k++) {
    printf("%4d %12.5g %12.6g %11.6g %11.4g\n", k + 1, (double)spectrum.re[k], (double)spectrum.im[k],
           (double)spectrum.im[k] / (2 * model_pi), (double)fb_spectrum_damping(&spectrum, k) + 0.0);
  }
  printf("stability margin: %.4g 1/s, of mode %d of %d%s\n", margin, worst + 1, spectrum.n,
         margin < 0 ? ": UNSTABLE" : "");
}

static void print_steps(const options *o, double spin)
{
  static const char *const name[3] = {"rk4", "implicit midpoint", "SDIRK2"};
  fb_body_limit here;
  if (model_body.n_rotor > 0 && fb_body_limit_eval(&model_body, &here, &state, &input) == FB_OK) {
    spin = (double)here.spin; /* their nutation is in it */
  }
  printf("steps for an error of %g over %g s, modes of amplitude 1:\n", o->tolerance, o->duration);
  for (int k = 0; k < 3; k++) {
    const double limit = (double)fb_spectrum_limit(&spectrum, (fb_integrator)k);
    const double accepted = (double)(k == FB_INTEGRATOR_RK4 ? fb_rk4_limit(&model_body, (fb_real)spin, FB_R(0.0))
                                                            : fb_implicit_limit(&model_body, (fb_real)spin, FB_R(0.0)));
    const double step =
        (double)fb_spectrum_dt(&spectrum, (fb_integrator)k, NULL, (fb_real)o->duration, (fb_real)o->tolerance);
    printf("  %-18s %.4g s", name[k], fmin(step, accepted));
    printf(limit < (double)FB_HUGE / 2 ? ", stable to %.4g s" : ", no limit of stability", limit);
    printf(accepted < (double)FB_HUGE / 2 ? ", accepted to %.4g s\n" : "\n", accepted);
  }
}

/* ---- the linear model */

/* The node of that name or number; -1: there is none. */
static int find_node(const char *name)
{
  for (int k = 0; k < model_body.n_node; k++) {
    if (name[0] && strcmp(model.node_name[k], name) == 0) {
      return k;
    }
  }
  return port_number(name, model_body.n_node);
}

/* The rotor of that name or number; -1: there is none. */
static int find_rotor(const char *name)
{
  for (int k = 0; k < model_body.n_rotor; k++) {
    if (strcmp(model.rotor[k].text.name, name) == 0) {
      return k;
    }
  }
  return port_number(name, model_body.n_rotor);
}

/* One port, as force.tip.y; where the base moves it there is no node; motor.wheel. 0, or 2 after a message. */
static int read_port(void *ports, int k, const char *option, const char *word)
{
  fb_port *const port = (fb_port *)ports + k;
  const char *const dot = strchr(word, '.');
  port_place place;
  int is_input;
  memset(port, 0, sizeof *port);
  port->kind = (fb_port_kind)port_kind(linear_ports, FB_PORT_COUNT, word);
  is_input = port->kind < FB_PORT_DISPLACEMENT || port->kind == FB_PORT_MOTOR;
  if (port->kind > FB_PORT_ROTOR_SPEED || (port->kind >= FB_PORT_DRIVE && port->kind < FB_PORT_MOTOR) ||
      is_input != (option[2] == 'i')) {
    return fail_port(option, word, "no such kind (see --help)");
  }
  if (port->kind >= FB_PORT_MOTOR) {
    port->axis = find_rotor(dot ? dot + 1 : "");
    return port->axis >= 0 ? 0 : fail_port(option, word, "no such rotor");
  }
  if (read_place(&place, option, word)) {
    return 2;
  }
  port->axis = place.axis;
  if (port->kind == FB_PORT_BASE_VELOCITY || port->kind == FB_PORT_BASE_RATE) {
    return !place.at[0] ? 0 : fail_port(option, word, "the base has no node");
  }
  port->node = find_node(place.at);
  return port->node >= 0 ? 0 : fail_port(option, word, "no such node");
}

/* Writes the linear model about the steady state. */
static int write_linear(const options *o)
{
  static linear_value in[FB_MAX_PORTS], out[FB_MAX_PORTS];
  static fb_linear_desc desc;
  static fb_linear linear;
  static linear_out file;
  fb_motion motion;
  char list[2][160];
  const int last = model_body.n_node - 1;
  fb_status status;
  snprintf(list[0], sizeof list[0], "force.%d.x,force.%d.y,force.%d.z,torque.0.x,torque.0.y,torque.0.z", last, last,
           last);
  snprintf(list[1], sizeof list[1], "displacement.%d.x,displacement.%d.y,displacement.%d.z,rate.0.x,rate.0.y,rate.0.z",
           last, last, last);
  if (read_ports(desc.in, &desc.n_in, in, "--inputs", o->inputs ? o->inputs : list[0], read_port) ||
      read_ports(desc.out, &desc.n_out, out, "--outputs", o->outputs ? o->outputs : list[1], read_port)) {
    return 2;
  }
  status = fb_body_motion_eval(&model_body, &motion, &state, &input);
  status = status ? status : fb_body_linearize(&model_body, &work, &linear, &state, &input, &desc);
  if (status != FB_OK) {
    fprintf(stderr, PROGRAM ": no linear model: %s\n", refusal_text(status));
    return 1;
  }
  linear_out_body(&file, o->file, &linear, &desc, &model_body, &state, &motion);
  for (int k = 0; k < desc.n_in; k++) {
    if (desc.in[k].kind == FB_PORT_MOTOR && model_body.rotor[desc.in[k].axis].given) {
      strcpy(file.in[k].unit, "N m s"); /* its momentum */
    }
  }
  return write_ports(&file, in, out, o->linear);
}

/* A free body falls with its gravity. */
static void leave_weight_out(void)
{
  if (model_body.base == FB_BASE_FREE) {
    model_body.effects &= ~(unsigned)FB_EFFECT_GRAVITY;
  }
}

/* [m] From the axis of the spin to the root of the first beam with modes of rest, by the velocity there, w x r. */
static double rest_radius(void)
{
  fb_motion motion;
  fb_real v[3], across[3];
  int k = 0;
  while (k + 1 < model.n_part && !model_part_rests(&model.part[k])) {
    k++;
  }
  if (fb_body_motion_eval(&model_body, &motion, &state, &input) != FB_OK) {
    return 0;
  }
  fb_vec3_cross(v, motion.w, model.part[k].position);
  for (int i = 0; i < 3; i++) {
    v[i] += motion.v[i];
  }
  fb_vec3_cross(across, motion.w, v);
  return sqrt((double)fb_vec3_dot(across, across)) / (double)fb_vec3_dot(motion.w, motion.w);
}

/* How far natural modes of rest take the slower half of the frequencies up: of two bases the one with the lower frequency
   is nearer to it (Rayleigh-Ritz). Builds the other one in the place of the body: nothing comes after. */
static void tell_rest(const char *file, const double axis[3], double spin)
{
  const double radius = rest_radius();
  const fb_spectrum was = spectrum;
  const char *what;
  double worst = 0;
  int at = 0;
  model_spin_modes(spin, radius);
  if (model_build(&what) != FB_OK || fb_state_init(&model_body, &state) != FB_OK) {
    return;
  }
  leave_weight_out();
  if (solve(axis, spin) != FB_OK || spectrum.n != was.n) {
    return;
  }
  for (int k = 0; 2 * k < spectrum.n; k++) {
    const double off = spectrum.im[k] > 0 ? (double)(was.im[k] / spectrum.im[k]) - 1 : 0;
    at = off > worst ? k : at;
    worst = fmax(worst, off);
  }
  if (worst > 1e-4) {
    fprintf(
        stderr,
        PROGRAM
        ": %s: warning: its modes are those of rest: %.6g rad/s is %.2g %% too high; a line `spin %.6g %.6g`, modes "
        "good for all speeds up to there, makes it %.6g rad/s\n",
        file, (double)was.im[at], 100 * worst, spin, radius, (double)spectrum.im[at]);
  }
}

int analyse_main(int argc, char **argv)
{
  static options o = {"examples/satellite.txt", NULL, NULL, NULL, {0, 0, 0}, 8, 1e-3, 60};
  const char *what;
  char lacks[160];
  double axis[3] = {0, 0, 1}, spin;
  const int named = argc > 1 && argv[1][0] != '-';
  int bad;
  fb_status status;
  output_begin(PROGRAM);
  bad = read_all(argc - named, argv + named, help, read_option, &o);
  o.file = named ? argv[1] : o.file;
  if (bad) {
    return bad;
  }
  if (!o.linear && (o.inputs || o.outputs)) {
    return fail("--inputs and --outputs are those of --linear FILE", "");
  }
  o.modes = floor(o.modes);
  if (!model_read(PROGRAM, o.file)) {
    return 2;
  }
  status = model_build(&what);
  status = status ? status : fb_state_init(&model_body, &state);
  if (status != FB_OK) {
    fprintf(stderr, PROGRAM ": %s: %s: %s\n", o.file, what, refusal_text(status));
    return 1;
  }
  leave_weight_out();
  spin = sqrt(o.spin[0] * o.spin[0] + o.spin[1] * o.spin[1] + o.spin[2] * o.spin[2]);
  for (int i = 0; i < 3 && spin > 0; i++) {
    axis[i] = o.spin[i] / spin;
  }
  if (spin > 0 && model_lacks_stiffening(lacks, axis)) {
    fprintf(stderr, PROGRAM ": %s: warning: %s\n", o.file, lacks);
  }
  printf("%s: %s, %d modes, mass %.6g kg, spin %.6g rad/s about (%.4g, %.4g, %.4g)\n", o.file, model.name, model_body.n,
         (double)model_body.mass, spin, axis[0], axis[1], axis[2]);
  status = solve(axis, spin);
  if (status != FB_OK) {
    return fail_at(spin, status);
  }
  print_trim();
  print_modes((int)o.modes);
  print_steps(&o, spin);
  bad = o.linear ? write_linear(&o) : 0;
  if (!bad && spin > 0 && model_rests()) {
    tell_rest(o.file, axis, spin);
  }
  return bad;
}
