/* scene_control.h - reads sampled controllers between outputs of a scene and its motors, actuators and loads. See
   scene.h; control.h has their blocks. */
#ifndef SCENE_CONTROL_H
#define SCENE_CONTROL_H
#include "scene_check.h"

/* Forces or torques with that many numbers. */
static int scene_read_force_or_torque(text_file *t, double vector[3])
{
  static const char *const kinds[] = {"force", "torque", NULL};
  const int torque = text_choice(t, "a load", kinds);
  text_vector(t, kinds[torque], vector, 3);
  return torque;
}

static const function function_of_one = {FUNCTION_CONSTANT, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0};

/* input OUTPUT [GAIN] [quantize Q] */
static void scene_read_sensor(text_file *t, const scene *s, scene_control *c)
{
  const int k = c->n_sensor;
  int rounded;
  if (k == SCENE_SENSORS) {
    text_fail(t, "more than %d inputs", SCENE_SENSORS);
    return;
  }
  c->sensor[k].output = scene_output_of(t, s);
  if (!t->failed && s->output[c->sensor[k].output].quantity == SCENE_COMMAND) {
    text_fail(t, "%s is a command: an input is what a sensor sees", s->output[c->sensor[k].output].label);
  }
  if (!t->failed && scene_is_internal(&s->output[c->sensor[k].output])) {
    text_fail(t, "%s is an internal load: a sensor of it is a gauge, with the output strain",
              s->output[c->sensor[k].output].label);
  }
  rounded = text_take(t, "quantize");
  c->sensor[k].gain = !rounded && text_more(t) ? text_number(t, "gain") : 1;
  rounded = rounded || text_take(t, "quantize");
  c->sensor[k].step = rounded ? control_positive(t, "quantize") : 0;
  c->n_sensor++;
}

/* Refuses a second controller of the same motor or actuator. */
static void scene_check_actor(text_file *t, const scene *s, int other, const char *what)
{
  if (other >= 0 && !t->failed) {
    text_fail(t, "%s has the controller %s already", what, s->control[other].name);
  }
}

/* motor JOINT AXIS: adds to what its line of the joint says */
static void scene_act_by_motor(text_file *t, scene *s, scene_control *c)
{
  scene_drive *const drive = &s->drive[s->n_drive];
  const int joint = scene_joint_of(t, s), axis = t->failed ? 0 : scene_read_axis(t, &s->joint[joint]);
  if (s->n_drive == SCENE_DRIVES) {
    text_fail(t, "more than %d drives", SCENE_DRIVES);
  }
  if (!t->failed && scene_axes(&s->joint[joint]) > 3) {
    text_fail(t, "a free joint has no motors: use load");
  }
  for (int k = 0; k < s->n_drive && !t->failed; k++) {
    if (s->drive[k].joint == joint && s->drive[k].axis == axis) {
      scene_check_actor(t, s, s->drive[k].control, "the motor");
    }
  }
  if (t->failed) {
    return;
  }
  memset(drive, 0, sizeof *drive);
  drive->kind = SCENE_MOTOR;
  drive->line = t->line;
  drive->joint = joint;
  drive->axis = axis;
  drive->control = s->n_control;
  drive->f = function_of_one;
  c->at = s->n_drive++;
  strcpy(c->unit, scene_axis_slides(&s->joint[joint], axis) ? "N" : "N m");
}

/* pull SPRING */
static void scene_act_by_pull(text_file *t, scene *s, scene_control *c)
{
  c->at = scene_spring_of(t, s);
  if (!t->failed) {
    scene_check_actor(t, s, s->spring[c->at].control, "the spring");
    s->spring[c->at].control = s->n_control;
  }
  strcpy(c->unit, "N");
}

/* rotor ROTOR: adds to its motor */
static void scene_act_by_rotor(text_file *t, scene *s, scene_control *c)
{
  c->at = scene_rotor_of(t, s);
  if (!t->failed && scene_rotor_desc(s, &s->rotor[c->at])->given) {
    text_fail(t, "the momentum of rotor %s is given: no motor", s->rotor[c->at].text.name);
  }
  if (!t->failed) {
    scene_check_actor(t, s, s->rotor[c->at].control, "the rotor");
    s->rotor[c->at].control = s->n_control;
  }
  strcpy(c->unit, "N m");
}

/* load NODE dead|follower|base force|torque X Y Z: the command times this vector */
static void scene_act_by_load(text_file *t, scene *s, scene_control *c)
{
  static const char *const axes[] = {"dead", "follower", "base", NULL};
  scene_load *const load = &s->load[s->n_load];
  if (s->n_load == SCENE_LOADS) {
    text_fail(t, "more than %d loads", SCENE_LOADS);
    return;
  }
  memset(load, 0, sizeof *load);
  scene_read_node(t, s, &load->body, &load->node);
  load->axes = (fb_axes)text_choice(t, "axes of a load", axes);
  load->torque = scene_read_force_or_torque(t, load->vector);
  load->f = function_of_one;
  load->control = s->n_control;
  c->at = s->n_load++;
  strcpy(c->unit, load->torque ? "N m" : "N");
}

/* output motor|pull|load|rotor .. */
static void scene_read_actor(text_file *t, scene *s, scene_control *c)
{
  static const char *const actors[] = {"motor", "pull", "load", "rotor", NULL};
  static void (*const read[])(text_file *, scene *, scene_control *) = {scene_act_by_motor, scene_act_by_pull,
                                                                        scene_act_by_load, scene_act_by_rotor};
  const int k = text_choice(t, "output of a controller", actors);
  c->actor = (scene_actor)(k + 1);
  read[k](t, s, c);
}

static void scene_read_control_block(text_file *t, scene_control *c, const char *word)
{
  control_block *const b = &c->block[c->n_block];
  if (c->n_block == SCENE_BLOCKS) {
    text_fail(t, "more than %d blocks", SCENE_BLOCKS);
    return;
  }
  if (!text_seen(&c->seen, "sample") && !t->failed) {
    for (int k = 0; control_words[k]; k++) {
      if (strcmp(control_words[k], word) == 0) {
        text_fail(t, "sample must stand before the blocks");
      }
    }
  }
  if (!control_read_block(t, b, word, c->sample)) {
    text_fail(t, "no such word for a controller: %s", word);
  }
  if (c->n_block > 0 && b[-1].kind >= CONTROL_THRUSTER) {
    text_fail(t, "nothing stands behind a thruster or pulse");
  }
  c->n_block++;
}

static void scene_read_control_line(text_file *t, scene *s, scene_control *c, const char *word)
{
  if (strcmp(word, "input") == 0) {
    scene_read_sensor(t, s, c);
  } else if (strcmp(word, "sample") == 0) {
    text_once(t, &c->seen, word);
    c->sample = control_positive(t, "sample");
  } else if (strcmp(word, "delay") == 0) {
    text_once(t, &c->seen, word);
    c->delay = control_not_negative(t, "delay");
  } else if (strcmp(word, "reference") == 0) {
    text_once(t, &c->seen, word);
    c->reference = function_read(t, &s->tables, s->path);
  } else if (strcmp(word, "output") == 0) {
    text_once(t, &c->seen, word);
    scene_read_actor(t, s, c);
  } else {
    scene_read_control_block(t, c, word);
  }
  text_end_of_line(t);
}

/* What is missing, at the line of the controller. */
static void scene_check_control(text_file *t, const scene_control *c)
{
  if (!text_seen(&c->seen, "sample")) {
    text_fail(t, "controller %s has no sample: its instants are at multiples of it", c->name);
  }
  if (c->n_sensor == 0) {
    text_fail(t, "controller %s has no input", c->name);
  }
  if (c->n_block == 0) {
    text_fail(t, "controller %s has no block", c->name);
  }
  if (c->actor == SCENE_BY_NONE) {
    text_fail(t, "controller %s has no output", c->name);
  }
  if (c->delay > SCENE_LATE * c->sample) {
    text_fail(t, "controller %s: a delay of %g s is more than %d samples", c->name, c->delay, SCENE_LATE);
  }
}

/* control NAME, its lines, end */
static void scene_read_control(text_file *t, scene *s)
{
  scene_control *const c = &s->control[s->n_control];
  const int begin = t->line;
  int last;
  if (s->n_control == SCENE_CONTROLS) {
    text_fail(t, "more than %d controllers", SCENE_CONTROLS);
    return;
  }
  memset(c, 0, sizeof *c);
  c->line = begin;
  text_name(t, "a controller", c->name);
  for (int k = 0; k < s->n_control; k++) {
    if (strcmp(s->control[k].name, c->name) == 0) {
      text_fail(t, "two controllers have the name %s", c->name);
    }
  }
  text_end_of_line(t);
  text_begin(t, "controller", c->name);
  while (text_within(t)) {
    scene_read_control_line(t, s, c, text_word(t));
  }
  last = t->line;
  t->line = begin;
  scene_check_control(t, c);
  t->line = last;
  s->n_control += !t->failed;
}
#endif
