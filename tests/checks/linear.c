/* linear.c - linear models of C, by examples/common/linear_out.h: a spinning beam with a rotor, bodies on joints that turn
   and slide, one of them in a loop, and an exact beam that spins and is bent. Writes FOLDER/spinning.json, FOLDER/exact.json
   and FOLDER/system.json, the first two as CSV, too, and prints the complex modes that the library finds: model, re, im. */
#define FB_WITH_DETAIL 1
#include "../../flexbeam.h"
#include "../../examples/common/linear_out.h"
#include "../../examples/common/refusal.h"

static fb_body body[3];
static fb_build_work build_work;
static fb_linear linear;
static fb_spectrum spectrum;
static linear_out out;

static const fb_beam_desc boom = {
    .length = 8, .n_element = 8, .n_station = 1, .station = {{.mass = FB_R(0.5), .EI_y = 2000, .EI_z = 3000}}};
static const fb_modes_desc keep = {.count = {2, 2}};

/* Writes the model, prints the spectrum of n modes. */
static int finish(const char *folder, const char *name, int csv, const fb_real *re, const fb_real *im, int n)
{
  char path[512];
  for (int k = 0; k <= csv; k++) {
    snprintf(path, sizeof path, "%s/%s.%s", folder, name, k ? "csv" : "json");
    if (linear_out_write(&out, path)) {
      printf("%s: %s\n", path, strerror(errno));
      return 1;
    }
  }
  for (int k = 0; k < n; k++) {
    printf("%s %.17g %.17g\n", name, (double)re[k], (double)im[k]);
  }
  return 0;
}

/* A boom on a base that turns at 2 rad/s, with a rotor whose bearing brakes it: by a force and its motor to a gyro and the
   deflection of its tip. */
static fb_status spin(void)
{
  static fb_analyse_work work;
  static fb_state state;
  const fb_linear_desc ports = {2,
                                3,
                                {{FB_PORT_FORCE, 0, 1, 1, FB_AXES_BODY}, {FB_PORT_MOTOR, 0, 0, 0, FB_AXES_BODY}},
                                {{FB_PORT_DISPLACEMENT, 0, 1, 1, FB_AXES_BODY},
                                 {FB_PORT_RATE, 0, 1, 2, FB_AXES_BODY},
                                 {FB_PORT_ROTOR_SPEED, 0, 0, 0, FB_AXES_BODY}}};
  fb_build_desc desc = {.n_part = 1,
                        .part = {{.n_node = 1, .node = {8}}},
                        .zeta = FB_R(0.01),
                        .body = {.effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING | FB_EFFECT_ROTORS,
                                 .base = FB_BASE_PRESCRIBED,
                                 .n_rotor = 1}};
  fb_rotor *const rotor = &desc.body.rotor[0];
  fb_input input = {.w = {0, 0, 2}};
  fb_motion motion;
  fb_status status;
  rotor->node = 1;
  rotor->axis[0] = 1;
  rotor->inertia = FB_R(0.2);
  rotor->damping = FB_R(0.1);
  status = fb_body_build(&body[0], &build_work, &desc, &boom, &keep, 1);
  status = status ? status : fb_state_init(&body[0], &state);
  status = status ? status : fb_body_trim(&body[0], &state, &work, &input);
  status = status ? status : fb_body_motion_eval(&body[0], &motion, &state, &input);
  status = status ? status : fb_body_linearize(&body[0], &work, &linear, &state, &input, &ports);
  status = status ? status : fb_body_spectrum_solve(&body[0], &work, &spectrum, &state, &input);
  if (status == FB_OK) {
    linear_out_body(&out, "spinning \"beam\", \\ with a rotor", &linear, &ports, &body[0], &state, &motion);
  }
  return status;
}

/* A cart on a spring slides and carries a boom on a damped hinge. A second cart slides beside it, joined to it: a loop, so
   that one of the two slides is no state. */
static fb_status connect(void)
{
  enum { CART, BOOM, OTHER };
  static fb_system system;
  static fb_system_work system_work;
  static fb_system_analyse_work work;
  static fb_system_state state;
  static fb_system_input input;
  static fb_system_motion motion;
  static fb_system_desc desc;
  static const linear_names names = {{"cart", "boom"}, {"slide", "hinge"}};
  const fb_linear_desc ports = {2,
                                3,
                                {{FB_PORT_DRIVE, CART, 0, 0, FB_AXES_BODY}, {FB_PORT_TORQUE, BOOM, 1, 2, FB_AXES_BODY}},
                                {{FB_PORT_COORDINATE, CART, 0, 0, FB_AXES_BODY},
                                 {FB_PORT_SPEED, BOOM, 0, 0, FB_AXES_BODY},
                                 {FB_PORT_DISPLACEMENT, BOOM, 1, 1, FB_AXES_BODY}}};
  const fb_build_desc rigid = {.mass = 10, .inertia = {1, 1, 1}, .body = {.base = FB_BASE_PRESCRIBED}};
  const fb_build_desc flexible = {.n_part = 1,
                                  .part = {{.n_node = 1, .node = {8}}},
                                  .zeta = FB_R(0.01),
                                  .body = {.effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING, .base = FB_BASE_PRESCRIBED}};
  fb_status status;
  status = fb_body_build(&body[CART], &build_work, &rigid, NULL, NULL, 0);
  status = status ? status : fb_body_build(&body[BOOM], &build_work, &flexible, &boom, &keep, 1);
  status = status ? status : fb_body_build(&body[OTHER], &build_work, &rigid, NULL, NULL, 0);
  memset(&desc, 0, sizeof desc);
  desc.n_body = 3;
  for (int k = 0; k < 3; k++) {
    desc.model[k] = k;
    desc.joint[k].kind = k == BOOM ? FB_JOINT_REVOLUTE : FB_JOINT_PRISMATIC;
    desc.joint[k].parent = k == BOOM ? CART : FB_GROUND;
    desc.joint[k].axis[0] = k != BOOM; /* along x */
  }
  desc.n_loop = 1;
  desc.loop[0].kind = FB_JOINT_RIGID;
  desc.loop[0].parent = CART;
  desc.loop[0].child = OTHER;
  desc.joint[CART].stiffness[0] = 500;
  desc.joint[CART].damping[0] = 3;
  desc.joint[BOOM].stiffness[0] = 800;
  desc.joint[BOOM].damping[0] = 20;
  status = status ? status : fb_system_init(&system, &system_work, body, &desc, 3);
  status = status ? status : fb_system_state_init(&system, body, &state, &system_work, NULL, NULL);
  status = status ? status : fb_system_motion_eval(&system, body, &system_work, &motion, &state, &input);
  status = status ? status : fb_system_linearize(&system, body, &work, &linear, &state, &input, &ports);
  status = status ? status : fb_system_spectrum_solve(&system, body, &work, &spectrum, &state, &input);
  if (status == FB_OK) {
    linear_out_system(&out, "cart", &linear, &ports, &system, body, 3, &state, &motion, &names);
  }
  return status;
}

static fb_exact_spectrum modes;

/* A beam of 10 m whose base turns at 0.5 rad/s, bent by a follower force: by a force there and the rate of the base to the
   deflection and the curvature at the root. */
static fb_status bend(void)
{
  static fb_exact exact;
  static fb_exact_work exact_work;
  static fb_exact_state state;
  static fb_exact_spectrum_work spectrum_work;
  static fb_exact_linear_work work;
  static fb_exact_linear of;
  static fb_exact_node node[13];
  static fb_exact_desc desc;
  static const fb_real stiffness[6] = {FB_R(1e6), FB_R(4e5), FB_R(4e5), 900, 2000, 3000};
  static const fb_real inertia[6] = {2, 2, 2, FB_R(0.02), FB_R(0.01), FB_R(0.01)};
  const fb_linear_desc ports = {
      2,
      2,
      {{FB_PORT_FORCE, 0, 12, 1, FB_AXES_BODY}, {FB_PORT_BASE_RATE, 0, 0, 2, FB_AXES_BODY}},
      {{FB_PORT_DISPLACEMENT, 0, 12, 1, FB_AXES_BODY}, {FB_PORT_MOMENT_STRAIN, 0, 0, 2, FB_AXES_BODY}}};
  fb_exact_input input = {.n_load = 1, .load = {{.node = 12, .axes = FB_AXES_NODE, .force = {0, 20, 5}}}};
  fb_status status;
  desc.length = 10;
  desc.n_element = 12;
  desc.n_station = 1;
  for (int i = 0; i < 6; i++) {
    desc.station[0].stiffness[7 * i] = stiffness[i];
    desc.station[0].inertia[7 * i] = inertia[i];
  }
  input.w[2] = FB_R(0.5);
  status = fb_exact_init(&exact, &desc);
  status = status ? status : fb_exact_state_init(&exact, &state, &exact_work, &input);
  status = status ? status : fb_exact_trim(&exact, &state, &exact_work, &input);
  status = status ? status : fb_exact_nodes_eval(&exact, node, &state);
  status = status ? status : fb_exact_linearize(&exact, &work, &of, &state, &input, &ports, 6);
  status = status ? status : fb_exact_spectrum_solve(&exact, &spectrum_work, &modes, &state, &input, 6);
  if (status == FB_OK) {
    linear_out_exact(&out, "exact", &of, &ports, &exact, node, &input);
  }
  return status;
}

int main(int argc, char **argv)
{
  fb_status status = argc == 2 ? spin() : FB_ERR_NULL;
  if (status == FB_OK && finish(argv[1], "spinning", 1, spectrum.re, spectrum.im, spectrum.n)) {
    return 1;
  }
  status = status ? status : bend();
  if (status == FB_OK && finish(argv[1], "exact", 1, modes.re, modes.im, modes.n)) {
    return 1;
  }
  status = status ? status : connect();
  if (status != FB_OK) {
    printf("%s\n", refusal_text(status));
    return 1;
  }
  return finish(argv[1], "system", 0, spectrum.re, spectrum.im, spectrum.n);
}
