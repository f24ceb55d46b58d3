/* fmu.c - the library stepped as the FMU of a description is in tests/checks/fmu.py: the same start, loads and steps, by
   the step functions themselves. A line of hexadecimal numbers after each communication step: all outputs of the FMU,
   in the order of its variables.
   usage: fmu FILE DT STEPS INTEGRATOR COUNT  (INTEGRATOR 1 to 4; COUNT communication steps of STEPS steps of DT) */
#include "examples/tools/capacities.h"
#include "flexbeam.h"
#include "examples/tools/model.h"
#include <stdlib.h>

static fb_state state;
static fb_input input[3];                            /* at the start, the middle and the end of a step */
static fb_real base_velocity[2][3], base_rate[2][3]; /* of a prescribed base, and their rates */
static fb_rk4_work rk4;
static fb_implicit_work implicit;
static fb_exponential exponential;
static fb_exponential_work exponential_work;

static fb_status begin(void)
{
  const fb_real held = model_body.base == FB_BASE_PRESCRIBED ? FB_R(0.0) : FB_R(1.0);
  const fb_real v[3] = {held, 0, FB_R(-0.5) * held}, w[3] = {FB_R(0.01) * held, FB_R(0.02) * held, FB_R(-0.03) * held};
  const fb_real quat[4] = {FB_R(0.8), 0, FB_R(0.6), 0};
  fb_real R[9], own[3];
  fb_status status = fb_state_init(&model_body, &state);
  memcpy(state.quat, quat, sizeof quat);
  status = status ? status : fb_quat_normalize(state.quat);
  state.rho[1] = 2;
  state.q[0] = FB_R(0.01);
  fb_quat_to_mat33(R, state.quat);
  fb_mat33_mulT_vec3(own, R, v);
  return status ? status : fb_state_from_velocity(&model_body, &state, own, w, NULL);
}

/* Loads of communication step k: whole multiples of 1/8, no rounding on the way here. */
static void load(int k)
{
  const int last = model_body.n_node - 1;
  fb_input *const in = input;
  in->n_load = model_body.n_node;
  for (int i = 0; i < in->n_load; i++) {
    in->load[i].node = i;
    in->load[i].axes = FB_AXES_BODY;
  }
  for (int i = 0; i < 3; i++) {
    in->load[0].force[i] = FB_R(0.5) * (fb_real)((k + i) % 3 - 1);
    in->load[0].torque[i] = FB_R(0.25) * (fb_real)((k + 2 * i) % 7 - 3);
    in->load[last].force[i] = FB_R(0.125) * (fb_real)((k + i) % 5 - 2);
    model_body.gravity[i] = FB_R(0.125) * (fb_real)((k + i) % 4 - 1);
    base_velocity[0][i] = FB_R(0.015625) * (fb_real)((k + i) % 3 - 1);
    base_rate[0][i] = FB_R(0.015625) * (fb_real)((k + 2 * i) % 5 - 2);
    base_velocity[1][i] = FB_R(0.25) * (fb_real)((k + i) % 4 - 1);
    base_rate[1][i] = FB_R(0.125) * (fb_real)((k + i) % 5 - 2);
  }
  input[1] = input[2] = *in;
}

/* The base moves on from where it was set. */
static void move(fb_input *in, fb_real after)
{
  for (int i = 0; i < 3 && model_body.base == FB_BASE_PRESCRIBED; i++) {
    in->v[i] = base_velocity[0][i] + after * base_velocity[1][i];
    in->w[i] = base_rate[0][i] + after * base_rate[1][i];
    in->v_dot[i] = base_velocity[1][i];
    in->w_dot[i] = base_rate[1][i];
  }
}

static fb_status step(int integrator, fb_real dt)
{
  const fb_input *const in = input;
  switch (integrator) {
  case 1:
    return fb_rk4_step(&model_body, &state, &rk4, in, in + 1, in + 2, dt);
  case 2:
    return fb_midpoint_step(&model_body, &state, &implicit, in + 1, dt, 0);
  case 3:
    return fb_sdirk_step(&model_body, &state, &implicit, in, in + 2, dt, 0);
  default:
    return fb_exponential_step(&model_body, &exponential, &state, &exponential_work, in, in + 1, in + 2);
  }
}

static void print(const fb_real *x, int n)
{
  for (int i = 0; i < n; i++) {
    printf("%a ", (double)x[i]);
  }
}

/* A quantity of all nodes from the first one on: kinds come before nodes. */
static void print_nodes(const fb_node_motion *node, const fb_motion *motion)
{
  for (int kind = 0; kind < 8; kind++) {
    for (int k = kind >= 6; k < model_body.n_node; k++) {
      fb_real R[9], rate[3], rate_dot[3];
      const fb_node_motion *const m = &node[k];
      const fb_real *const list[] = {m->position,          m->quat,         m->velocity,
                                     k ? rate : motion->w, m->acceleration, k ? rate_dot : motion->w_dot,
                                     m->displacement,      m->rotation};
      fb_quat_to_mat33(R, m->quat);
      fb_mat33_mulT_vec3(rate, R, m->angular_rate);
      fb_mat33_mulT_vec3(rate_dot, R, m->angular_acceleration);
      print(list[kind], kind == 1 ? 4 : 3);
    }
  }
}

static fb_status print_outputs(void)
{
  fb_motion motion;
  fb_node_motion node[FB_MAX_NODES];
  fb_energy energy;
  fb_status status = fb_body_motion_eval(&model_body, &motion, &state, input);
  status = status ? status : fb_body_energy_eval(&model_body, &energy, &state, input);
  for (int k = 0; k < model_body.n_node && status == FB_OK; k++) {
    status = fb_body_node_motion_eval(&model_body, &node[k], &state, &motion, k);
  }
  if (status != FB_OK) {
    return status;
  }
  print_nodes(node, &motion);
  if (model_body.base != FB_BASE_FREE) {
    print(motion.reaction_force, 3);
    print(motion.reaction_torque, 3);
  }
  print(state.q, model_body.n);
  print(motion.q_dot, model_body.n);
  printf("%a %a %a\n", (double)energy.kinetic, (double)energy.strain, (double)energy.gravity);
  return FB_OK;
}

int main(int argc, char **argv)
{
  const char *what = "arguments";
  const double dt = argc == 6 ? strtod(argv[2], NULL) : 0;
  const int steps = argc == 6 ? (int)strtol(argv[3], NULL, 10) : 0;
  const int integrator = argc == 6 ? (int)strtol(argv[4], NULL, 10) : 0;
  const int count = argc == 6 ? (int)strtol(argv[5], NULL, 10) : 0;
  fb_status status = FB_ERR_VALUE;
  if (argc == 6 && model_read("fmu", argv[1])) {
    model.level.effects |= FB_EFFECT_GRAVITY;
    status = model_build(&what);
    what = "motion";
  }
  if (status == FB_OK && integrator == 4) {
    status = fb_exponential_init(&exponential, &model_body_work, &model_body, (fb_real)dt);
  }
  status = status ? status : begin();
  for (int k = 0; k < count && status == FB_OK; k++) {
    load(k);
    for (int i = 0; i < steps && status == FB_OK; i++) {
      for (int at = 0; at < 3; at++) {
        move(&input[at], ((fb_real)i + FB_R(0.5) * (fb_real)at) * (fb_real)dt);
      }
      status = step(integrator, (fb_real)dt);
    }
    move(input, (fb_real)steps * (fb_real)dt);
    status = status ? status : print_outputs();
  }
  if (status != FB_OK) {
    fprintf(stderr, "fmu: %s: %s\n", what, refusal_text(status));
  }
  return status != FB_OK;
}
