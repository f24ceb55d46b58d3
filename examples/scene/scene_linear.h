/* scene_linear.h - the linear model of a scene about its start: inputs and outputs by their words, and its file. See
   scene.h. */
#ifndef SCENE_LINEAR_H
#define SCENE_LINEAR_H
#include "scene_engine.h"
#define LINEAR_OUT_PORTS SCENE_OUTPUTS
#include "../common/linear_out.h"

static struct scene_plant {
  fb_linear_desc desc;
  fb_linear linear;
  fb_real B[FB_MAX_LINEAR * SCENE_OUTPUTS], C[SCENE_OUTPUTS * FB_MAX_LINEAR], D[SCENE_OUTPUTS * SCENE_OUTPUTS];
  linear_out file;
} plant;

static struct scene_exact_plant {
  fb_linear_desc desc;
  fb_exact_linear linear;
  fb_exact_linear_work work;
} exact_plant;

/* ---- ports */

/* The port of the model, new or there already; -1: there are too many. */
static int plant_port(fb_port *port, int *n, fb_port_kind kind, int body, int node, int axis)
{
  const fb_port wanted = {kind, body, node, axis, FB_AXES_BODY};
  for (int k = 0; k < *n; k++) {
    if (port[k].kind == kind && port[k].body == body && port[k].node == node && port[k].axis == axis) {
      return k;
    }
  }
  if (*n == FB_MAX_PORTS) {
    return -1;
  }
  port[*n] = wanted;
  return (*n)++;
}

/* A motor, actuator, rotor or load as ports and their weights: how many there are. */
static int plant_actor(const scene *s, scene_actor actor, int at, int port[3], double weight[3])
{
  fb_linear_desc *const d = &plant.desc;
  const scene_load *load;
  fb_real vector[3], inertial[3], R[9];
  fb_node_motion node;
  int n = 0;
  weight[0] = 1;
  if (actor == SCENE_BY_MOTOR) {
    const scene_drive *const drive = &s->drive[at];
    port[0] = plant_port(d->in, &d->n_in, FB_PORT_DRIVE, s->joint[drive->joint].at, 0, drive->axis);
    return 1;
  }
  if (actor == SCENE_BY_PULL) {
    port[0] = plant_port(d->in, &d->n_in, FB_PORT_PULL, at, 0, 0);
    return 1;
  }
  if (actor == SCENE_BY_ROTOR) {
    port[0] = plant_port(d->in, &d->n_in, FB_PORT_MOTOR, s->rotor[at].body, 0, s->rotor[at].at);
    return 1;
  }
  load = &s->load[at];
  scene_reals(vector, load->vector, 3);
  if (load->axes == FB_AXES_INERTIAL || load->axes == FB_AXES_NODE) { /* to those of the body */
    if (fb_body_node_motion_eval(&engine.body[load->body], &node, &engine.view.motion.pose[load->body],
                                 &engine.view.motion.motion[load->body], load->node) != FB_OK) {
      return -1;
    }
    fb_quat_to_mat33(R, node.quat);
    fb_mat33_mul_vec3(inertial, R, vector);
    fb_quat_to_mat33(R, engine.view.motion.pose[load->body].quat);
    fb_mat33_mulT_vec3(vector, R, load->axes == FB_AXES_NODE ? inertial : vector);
  }
  for (int i = 0; i < 3; i++) {
    if (FB_FABS(vector[i]) > 0) {
      port[n] = plant_port(d->in, &d->n_in, load->torque ? FB_PORT_TORQUE : FB_PORT_FORCE, load->body, load->node, i);
      weight[n++] = (double)vector[i];
    }
  }
  return n;
}

/* Free axes of the bodies of a system before that one. */
static int plant_axes_before(const scene *s, int body)
{
  int n = 0, axis[6];
  for (int b = 0; b < body && scene_is_system(s); b++) {
    n += linear_free_axes(axis, &engine.system, &engine.system_state, b);
  }
  return n;
}

/* The state that is coordinate k among all free axes and modal coordinates; -1: it is none. */
static int plant_state(int k)
{
  for (int i = 0; i < (plant.linear.n - plant.linear.n_rotor) / 2; i++) {
    if (plant.linear.coordinate[i] == k) {
      return i;
    }
  }
  return -1;
}

/* The first state of the attitude of a free body, of three; -1: it has none. */
static int plant_attitude(const scene *s, int body)
{
  if (!scene_is_system(s)) {
    return s->body[0].level.base == FB_BASE_FREE ? plant.linear.n - 3 : -1;
  }
  if (engine.system.joint[body].kind != FB_JOINT_FREE || engine.system_state.mode[body][0] != FB_AXIS_FREE) {
    return -1;
  }
  return plant_state(plant_axes_before(s, body) + 3);
}

/* Adds what is part of the state itself to a row of C: attitude, modes, strains. 0: it is not. */
static int plant_add_state(const scene *s, double *row, const scene_output *o, double gain)
{
  const int body = o->body, all = plant_axes_before(s, s->n_body);
  int modes = all, at;
  for (int b = 0; b < body; b++) {
    modes += engine.body[b].n;
  }
  if (o->quantity == SCENE_ATTITUDE) {
    const fb_real *const q = engine.view.motion.pose[body].quat;
    const double turn[4][3] = {{-(double)q[1], -(double)q[2], -(double)q[3]}, /* q (0, e_i) / 2, w to z by rows */
                               {(double)q[0], -(double)q[3], (double)q[2]},
                               {(double)q[3], (double)q[0], -(double)q[1]},
                               {-(double)q[2], (double)q[1], (double)q[0]}};
    at = plant_attitude(s, body);
    for (int i = 0; i < 3 && at >= 0; i++) {
      row[at + i] += gain * 0.5 * turn[o->axis][i];
    }
    return at >= 0;
  }
  for (int a = 0; a < FB_MAX_MODES && (o->quantity == SCENE_MODE || o->quantity == SCENE_STRAIN); a++) {
    const fb_gauge *const gauge = &s->body[body].gauge[o->at];
    const double part = o->quantity == SCENE_MODE ? a == o->at : a < gauge->n ? (double)gauge->gain[a] : 0;
    const int place = engine.place[body][a];
    at = place < 0 || !(fabs(part) > 0) ? 0 : plant_state(modes + place);
    if (at < 0) {
      return 0;
    }
    row[at] += place < 0 ? 0 : gain * part;
  }
  return o->quantity == SCENE_MODE || o->quantity == SCENE_STRAIN;
}

/* The port that an output is; -1: it is none, -2: there are too many. */
static int plant_sensor(const scene *s, const scene_output *o)
{
  static const struct {
    scene_quantity quantity;
    fb_port_kind kind;
  } kinds[] = {{SCENE_DISPLACEMENT, FB_PORT_DISPLACEMENT},
               {SCENE_ROTATION, FB_PORT_ROTATION},
               {SCENE_GYRO, FB_PORT_RATE},
               {SCENE_SPIN, FB_PORT_RATE},
               {SCENE_SPECIFIC_FORCE, FB_PORT_ACCELERATION},
               {SCENE_COORDINATE, FB_PORT_COORDINATE},
               {SCENE_COORDINATE_RATE, FB_PORT_SPEED},
               {SCENE_LENGTH, FB_PORT_LENGTH},
               {SCENE_ROTOR_SPEED, FB_PORT_ROTOR_SPEED}};
  fb_linear_desc *const d = &plant.desc;
  for (int k = 0; k < (int)(sizeof kinds / sizeof *kinds); k++) {
    const scene_place place = scene_quantities[o->quantity].place;
    int body = o->body, node = o->at, port;
    if (kinds[k].quantity != o->quantity) {
      continue;
    }
    if (place == SCENE_AT_AXIS) {
      if (scene_axes(&s->joint[o->at]) > 2) {
        return -1;
      }
      body = s->joint[o->at].at;
    } else if (place == SCENE_AT_SPRING) {
      body = o->at;
    }
    node = place == SCENE_AT_NODE ? o->at : 0;
    port = plant_port(d->out, &d->n_out, kinds[k].kind, body, node,
                      place == SCENE_AT_SPRING  ? 0
                      : place == SCENE_AT_ROTOR ? s->rotor[o->at].at
                                                : o->axis);
    return port < 0 ? -2 : port;
  }
  return -1;
}

/* ---- the model */

/* Before ports are chosen: none, and where everything is. */
static fb_status plant_begin(const scene *s)
{
  memset(&plant.desc, 0, sizeof plant.desc);
  memset(&exact_plant.desc, 0, sizeof exact_plant.desc);
  return scene_look(s, 0);
}

/* About the start, for the ports chosen; what falls has no weight. */
static fb_status plant_solve(const scene *s)
{
  fb_real weight[FB_MAX_BODIES][3];
  fb_status status;
  scene_drop_weight(s, weight);
  if (scene_is_system(s)) {
    system_input(s, &engine.system_at[0], 0, 0);
    status = fb_system_linearize(&engine.system, engine.body, &engine.system_analyse, &plant.linear,
                                 &engine.system_state, &engine.system_at[0], &plant.desc);
  } else {
    single_input(s, &engine.at[0], 0, 0);
    status = fb_body_linearize(&engine.body[0], &engine.analyse, &plant.linear,
                               engine.is_formed ? &engine.plain : &engine.state, &engine.at[0], &plant.desc);
  }
  scene_put_weight(s, weight);
  return status;
}

/* ---- of an exact beam: loads on its nodes; deflections of a root that is held, gyros */

/* A load as ports and their weights: how many there are; -1: too many. */
static int exact_plant_load(const scene *s, const scene_load *load, int port[3], double weight[3])
{
  fb_linear_desc *const d = &exact_plant.desc;
  int n = 0;
  for (int i = 0; i < 3; i++) {
    const fb_port wanted = {load->torque ? FB_PORT_TORQUE : FB_PORT_FORCE, 0, s->body[0].element_node[load->node], i,
                            load->axes};
    if (fabs(load->vector[i]) <= 0) {
      continue;
    }
    if (d->n_in == FB_MAX_PORTS) {
      return -1;
    }
    port[n] = d->n_in;
    weight[n++] = load->vector[i];
    d->in[d->n_in++] = wanted;
  }
  return n;
}

/* As plant_sensor. */
static int exact_plant_sensor(const scene *s, const scene_output *o)
{
  fb_linear_desc *const d = &exact_plant.desc;
  const int held = (exact_run.beam.held[0] & FB_END_CLAMPED) == FB_END_CLAMPED;
  const fb_port wanted = {o->quantity == SCENE_GYRO ? FB_PORT_RATE : FB_PORT_DISPLACEMENT, 0,
                          s->body[0].element_node[o->at], o->axis, FB_AXES_BODY};
  if (o->quantity != SCENE_GYRO && (o->quantity != SCENE_DISPLACEMENT || !held)) {
    return -1;
  }
  if (d->n_out == FB_MAX_PORTS) {
    return -2;
  }
  d->out[d->n_out] = wanted;
  return d->n_out++;
}

/* The modes that the beam's description asks for, in the place of a linear model of bodies. */
static fb_status exact_plant_solve(const scene *s)
{
  const fb_exact_linear *const l = &exact_plant.linear;
  fb_status status;
  exact_start_input(s);
  status = fb_exact_linearize(&exact_run.beam, &exact_plant.work, &exact_plant.linear, &exact_run.state,
                              &exact_run.input, &exact_plant.desc, s->exact.modes);
  if (status == FB_OK) {
    plant.linear.n = l->n;
    plant.linear.n_in = l->n_in;
    plant.linear.n_out = l->n_out;
    memcpy(plant.linear.A, l->A, (size_t)(l->n * l->n) * sizeof *l->A);
    memcpy(plant.linear.B, l->B, (size_t)(l->n * l->n_in) * sizeof *l->B);
    memcpy(plant.linear.C, l->C, (size_t)(l->n_out * l->n) * sizeof *l->C);
    memcpy(plant.linear.D, l->D, (size_t)(l->n_out * l->n_in) * sizeof *l->D);
  }
  return status;
}
typedef char scenes_hold_exact_models[FB_MAX_LINEAR >= FB_EXACT_STATES ? 1 : -1];

/* ---- its file */

typedef struct plant_input { /* a motor, actuator, rotor or load of the scene */
  scene_actor actor;
  int at, n, port[3];
  double weight[3];
} plant_input;

/* Its name, and the unit in SI. */
static const char *plant_input_name(char name[80], const scene *s, const plant_input *in)
{
  if (in->actor == SCENE_BY_MOTOR) {
    const scene_drive *const drive = &s->drive[in->at];
    snprintf(name, 80, "motor.%s.%d", s->joint[drive->joint].name, drive->axis + 1);
    return scene_axis_slides(&s->joint[drive->joint], drive->axis) ? "N" : "N m";
  }
  if (in->actor == SCENE_BY_PULL) {
    snprintf(name, 80, "pull.%s", s->spring[in->at].name);
    return "N";
  }
  if (in->actor == SCENE_BY_ROTOR) {
    snprintf(name, 80, "rotor.%s", s->rotor[in->at].text.name);
    return s->body[s->rotor[in->at].body].level.rotor[s->rotor[in->at].at].given ? "N m s" : "N m";
  }
  const scene_load *const load = &s->load[in->at];
  const scene_body *const body = &s->body[load->body];
  const char *const node = body->node_name[load->node];
  char number[16];
  snprintf(number, sizeof number, "%d", load->node);
  snprintf(name, 80, "%s.%s.%s", load->torque ? "torque" : "force", body->name, node[0] ? node : number);
  return load->torque ? "N m" : "N";
}

/* Its name, with a number behind where another has it, and its unit: a load is counted by its vector. */
static void plant_name_input(const scene *s, const plant_input *in, int k)
{
  linear_value *const v = &plant.file.in[k];
  scene_output as = {0};
  char name[80];
  double size = 0;
  int same = 1;
  scene_unit(s, &as, plant_input_name(name, s, in));
  for (int i = 0; i < 3 && in->actor == SCENE_BY_LOAD; i++) {
    size = hypot(size, s->load[in->at].vector[i]);
  }
  if (in->actor == SCENE_BY_LOAD && fabs(size - 1) > 0) {
    snprintf(v->unit, sizeof v->unit, "%.6g %.16s", size, as.unit);
  } else {
    snprintf(v->unit, sizeof v->unit, "%.31s", as.unit);
  }
  snprintf(v->name, sizeof v->name, "%s", name);
  for (int i = 0; i < k; i++) {
    if (strcmp(plant.file.in[i].name, v->name) == 0) {
      snprintf(v->name, sizeof v->name, "%.66s.%d", name, ++same);
      i = -1;
    }
  }
}

/* What the scene moves itself by: loads, motors of free axes, actuators, rotors. How many; -1: more than ports. */
static int plant_inputs(plant_input in[SCENE_OUTPUTS], const scene *s)
{
  int n = 0;
  for (int actor = SCENE_BY_MOTOR; actor <= SCENE_BY_ROTOR; actor++) {
    const int count[] = {0, s->n_drive, s->n_spring, s->n_load, s->n_rotor};
    for (int k = 0; k < count[actor]; k++) {
      plant_input *const to = &in[n];
      const scene_joint *const joint = actor == SCENE_BY_MOTOR ? &s->joint[s->drive[k].joint] : NULL;
      if ((joint &&
           (s->drive[k].kind != SCENE_MOTOR || joint->loop ||
            engine.system_state.mode[joint->at][scene_axes(joint) < 3 ? s->drive[k].axis : 0] != FB_AXIS_FREE)) ||
          (actor == SCENE_BY_PULL && !s->spring[k].pulls && s->spring[k].act < 0) ||
          (actor == SCENE_BY_LOAD && s->load[k].nudge)) {
        continue;
      }
      if (n == SCENE_OUTPUTS) {
        return -1;
      }
      to->actor = (scene_actor)actor;
      to->at = k;
      to->n = s->is_exact ? exact_plant_load(s, &s->load[k], to->port, to->weight)
                          : plant_actor(s, to->actor, k, to->port, to->weight);
      for (int i = 0; i < to->n || to->n < 0; i++) {
        if (to->n < 0 || to->port[i] < 0) {
          return -1;
        }
      }
      n++;
    }
  }
  return n;
}

/* B and D of the inputs, from those of the ports; rows of C and D of the outputs that are ports or part of the state.
   Returns how many outputs there are. */
static int plant_fill(const scene *s, const plant_input *in, int n_in, const int sensor[SCENE_OUTPUTS])
{
  const fb_linear *const l = &plant.linear;
  double row[FB_MAX_LINEAR];
  int n_out = 0;
  memset(plant.B, 0, sizeof plant.B);
  memset(plant.D, 0, sizeof plant.D);
  for (int k = 0; k < n_in; k++) {
    for (int p = 0; p < in[k].n; p++) {
      for (int i = 0; i < l->n; i++) {
        plant.B[n_in * i + k] += (fb_real)in[k].weight[p] * l->B[l->n_in * i + in[k].port[p]];
      }
    }
  }
  for (int o = 0; o < s->n_output; o++) {
    memset(row, 0, sizeof row);
    if (sensor[o] < 0 && (s->is_exact || !plant_add_state(s, row, &s->output[o], 1))) {
      continue;
    }
    for (int j = 0; j < l->n; j++) {
      plant.C[l->n * n_out + j] = sensor[o] < 0 ? (fb_real)row[j] : l->C[l->n * sensor[o] + j];
    }
    for (int k = 0; k < n_in && sensor[o] >= 0; k++) {
      for (int p = 0; p < in[k].n; p++) {
        plant.D[n_in * n_out + k] += (fb_real)in[k].weight[p] * l->D[l->n_in * sensor[o] + in[k].port[p]];
      }
    }
    snprintf(plant.file.out[n_out].name, sizeof plant.file.out[n_out].name, "%s", s->output[o].label);
    snprintf(plant.file.out[n_out].unit, sizeof plant.file.out[n_out].unit, "%s", s->output[o].unit);
    n_out++;
  }
  return n_out;
}

/* States and steady state, by the scene's names; names of ports are for others to replace. */
static void plant_describe(const scene *s)
{
  static linear_names names;
  const fb_system_motion *const m = &engine.view.motion;
  scene_output as = {0};
  memset(&names, 0, sizeof names);
  for (int b = 0; b < s->n_body; b++) {
    names.body[b] = names.joint[b] = s->body[b].name;
  }
  for (int j = 0; j < s->n_joint; j++) {
    if (!s->joint[j].loop) {
      names.joint[s->joint[j].at] = s->joint[j].name;
    }
  }
  if (s->is_exact) {
    linear_out_exact(&plant.file, s->path, &exact_plant.linear, &exact_plant.desc, &exact_run.beam, exact_run.node,
                     &exact_run.input);
  } else if (scene_is_system(s)) {
    linear_out_system(&plant.file, s->path, &plant.linear, &plant.desc, &engine.system, engine.body, s->n_body,
                      &engine.system_state, m, &names);
  } else {
    linear_out_body(&plant.file, s->path, &plant.linear, &plant.desc, &engine.body[0], &engine.state, &m->motion[0]);
  }
  for (int k = 0; k < plant.file.n + plant.file.n_point; k++) {
    linear_value *const v = k < plant.file.n ? &plant.file.state[k] : &plant.file.point[k - plant.file.n];
    scene_unit(s, &as, v->unit);
    memcpy(v->unit, as.unit, sizeof as.unit);
  }
}

/* The linear model about the start, in plant.file: inputs are all loads, motors, actuators and rotors of the scene,
   outputs all its outputs that are functions of state and inputs. 1: the reason is in s->message. */
static int scene_linearize(scene *s)
{
  plant_input in[SCENE_OUTPUTS];
  int sensor[SCENE_OUTPUTS], n_in;
  fb_status status;
  if (s->is_exact && !s->trim) {
    return scene_fail(s, "linear model: of an exact beam about its steady state alone: add a line trim");
  }
  status = plant_begin(s);
  n_in = status ? 0 : plant_inputs(in, s);
  if (n_in < 0) {
    return scene_fail(s, "linear model: loads, motors, actuators and rotors have more than %d components together",
                      FB_MAX_PORTS);
  }
  for (int o = 0; o < s->n_output; o++) {
    sensor[o] = (s->is_exact ? exact_plant_sensor : plant_sensor)(s, &s->output[o]);
    if (sensor[o] == -2) {
      return scene_fail(s, "linear model: output %s and those before it are more than %d sensors", s->output[o].label,
                        FB_MAX_PORTS);
    }
  }
  status = status ? status : (s->is_exact ? exact_plant_solve : plant_solve)(s);
  if (status != FB_OK) {
    return scene_fail(s, "no linear model about the start: %s", refusal_text(status));
  }
  plant_describe(s);
  plant.file.n_out = plant_fill(s, in, n_in, sensor);
  for (int k = 0; k < n_in; k++) {
    plant_name_input(s, &in[k], k);
  }
  plant.file.n_in = n_in;
  plant.file.B = plant.B;
  plant.file.C = plant.C;
  plant.file.D = plant.D;
  return 0;
}

/* Writes it, where it is asked for. */
static int scene_write_linear(scene *s, const char *name, FILE *talk)
{
  if (!name) {
    return 0;
  }
  if (scene_linearize(s)) {
    return 1;
  }
  if (linear_out_write(&plant.file, name)) {
    return scene_fail(s, "cannot write %s: %s%s", name, output_why(), output_left(name));
  }
  if (talk) {
    fprintf(talk, "linear model: %d states, %d inputs, %d of %d outputs\n", plant.file.n, plant.file.n_in,
            plant.file.n_out, s->n_output);
  }
  return 0;
}
#endif
