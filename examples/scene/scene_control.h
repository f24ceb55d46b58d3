/* scene_control.h - reads sampled controllers between outputs of a scene and its motors, actuators and loads, and how their
   commands are allocated to several of these. See scene.h; control.h has their blocks. */
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

/* ---- actuators */

/* motor JOINT AXIS: adds to what its line of the joint says */
static void scene_act_by_motor(text_file *t, scene *s, scene_act *act)
{
  scene_drive *const drive = &s->drive[s->n_drive];
  const int joint = scene_joint_of(t, s), axis = t->failed ? 0 : scene_read_axis(t, &s->joint[joint]);
  if (s->n_drive == SCENE_DRIVES) {
    text_fail(t, "more than %d drives", SCENE_DRIVES);
  }
  if (!t->failed && scene_axes(&s->joint[joint]) > 3) {
    text_fail(t, "a free joint has no motors: use load");
  }
  if (t->failed) {
    return;
  }
  memset(drive, 0, sizeof *drive);
  drive->kind = SCENE_MOTOR;
  drive->line = t->line;
  drive->joint = joint;
  drive->axis = axis;
  drive->act = s->n_act;
  drive->f = function_of_one;
  act->at = s->n_drive++;
  strcpy(act->unit, scene_axis_slides(&s->joint[joint], axis) ? "N" : "N m");
}

/* pull SPRING */
static void scene_act_by_pull(text_file *t, scene *s, scene_act *act)
{
  act->at = scene_spring_of(t, s);
  if (!t->failed) {
    act->next = s->spring[act->at].act;
    s->spring[act->at].act = s->n_act;
  }
  strcpy(act->unit, "N");
}

/* rotor ROTOR: adds to its motor */
static void scene_act_by_rotor(text_file *t, scene *s, scene_act *act)
{
  act->at = scene_rotor_of(t, s);
  if (!t->failed && scene_rotor_desc(s, &s->rotor[act->at])->given) {
    text_fail(t, "the momentum of rotor %s is given: no motor", s->rotor[act->at].text.name);
  }
  if (!t->failed) {
    act->next = s->rotor[act->at].act;
    s->rotor[act->at].act = s->n_act;
  }
  strcpy(act->unit, "N m");
}

/* load NODE dead|follower|base force|torque X Y Z: what is commanded times this vector */
static void scene_act_by_load(text_file *t, scene *s, scene_act *act)
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
  load->act = s->n_act;
  act->at = s->n_load++;
  strcpy(act->unit, load->torque ? "N m" : "N");
}

static const char *const scene_actors[] = {"motor", "pull", "load", "rotor", "allocation", NULL};

/* The actuator of that kind, one more of the allocation that is read; NULL: there is no room. */
static scene_act *scene_read_act(text_file *t, scene *s, scene_actor actor)
{
  static void (*const read[])(text_file *, scene *, scene_act *) = {scene_act_by_motor, scene_act_by_pull,
                                                                    scene_act_by_load, scene_act_by_rotor};
  scene_act *const act = &s->act[s->n_act];
  if (s->n_act == SCENE_ACTS) {
    text_fail(t, "more than %d actuators of controllers", SCENE_ACTS);
    return NULL;
  }
  memset(act, 0, sizeof *act);
  act->actor = actor;
  act->next = -1;
  act->gain[0] = 1;
  act->low = -HUGE_VAL;
  act->high = HUGE_VAL;
  read[actor - SCENE_BY_MOTOR](t, s, act);
  return act;
}

/* One more allocation; NULL: there is no room. */
static scene_allocation *scene_begin_allocation(text_file *t, scene *s, int n)
{
  scene_allocation *const a = &s->allocation[s->n_allocation];
  if (s->n_allocation == SCENE_ALLOCATIONS) {
    text_fail(t, "more than %d allocations", SCENE_ALLOCATIONS - SCENE_CONTROLS);
    return NULL;
  }
  memset(a, 0, sizeof *a);
  a->line = t->line;
  a->n = n;
  a->first = s->n_act;
  return a;
}

/* motor|pull|load|rotor .. gains G .. [limit U, or limit LOW HIGH] */
static void scene_read_allocated(text_file *t, scene *s, scene_allocation *a, const char *word)
{
  scene_act *act;
  int k = 0;
  while (scene_actors[k] && strcmp(scene_actors[k], word) != 0) {
    k++;
  }
  if (k > SCENE_BY_ROTOR - SCENE_BY_MOTOR) {
    text_fail(t, "a line of an allocation begins with motor, pull, load or rotor, not with %s", word);
    return;
  }
  act = scene_read_act(t, s, (scene_actor)(k + SCENE_BY_MOTOR));
  if (!act) {
    return;
  }
  scene_expect(t, "gains");
  text_vector(t, "gain of a command", act->gain, a->n);
  if (text_take(t, "limit")) {
    act->high = text_number(t, "limit");
    act->low = -act->high;
    if (text_more(t)) {
      act->low = act->high;
      act->high = text_number(t, "upper limit");
    }
    if (!t->failed && !(act->low <= 0 && act->high >= 0 && act->low < act->high)) {
      text_fail(t, "a limit is a size, or from 0 or below to 0 or above: %g to %g", act->low, act->high);
    }
  }
  text_end_of_line(t);
  s->n_act++;
  a->n_act++;
}

/* allocation NAME COMMANDS, its lines, end */
static void scene_read_allocation(text_file *t, scene *s)
{
  scene_allocation *a = scene_begin_allocation(t, s, 1);
  char name[TEXT_NAME] = "";
  text_name(t, "an allocation", name);
  for (int k = 0; k < s->n_allocation; k++) {
    if (strcmp(s->allocation[k].name, name) == 0) {
      text_fail(t, "two allocations have the name %s", name);
    }
  }
  if (!a) {
    return;
  }
  strcpy(a->name, name);
  a->n = text_whole(t, "number of commands", 1, CONTROL_SIGNALS);
  text_end_of_line(t);
  text_begin(t, "allocation", a->name);
  while (text_within(t)) {
    scene_read_allocated(t, s, a, text_word(t));
  }
  if (a->n_act == 0) {
    t->line = a->line;
    text_fail(t, "allocation %s has no actuator", a->name);
  }
  s->n_allocation += !t->failed;
}

/* ---- what comes in */

/* input OUTPUT [GAIN ..] [quantize Q]: a gain for each signal */
static void scene_read_sensor(text_file *t, const scene *s, scene_control *c)
{
  const int k = c->n_sensor;
  int rounded;
  if (k == SCENE_SENSORS) {
    text_fail(t, "more than %d inputs", SCENE_SENSORS);
    return;
  }
  if (c->attitude.is) {
    text_fail(t, "a controller of attitude has no input: it sees attitude and rate");
  }
  c->sensor[k].output = scene_output_of(t, s);
  if (!t->failed && scene_quantities[s->output[c->sensor[k].output].quantity].place >= SCENE_AT_CONTROL &&
      scene_quantities[s->output[c->sensor[k].output].quantity].place <= SCENE_AT_ALLOCATION) {
    text_fail(t, "%s is a command: an input is what a sensor sees", s->output[c->sensor[k].output].label);
  }
  if (!t->failed && scene_is_internal(&s->output[c->sensor[k].output])) {
    text_fail(t, "%s is an internal load: a sensor of it is a gauge, with the output strain",
              s->output[c->sensor[k].output].label);
  }
  rounded = text_take(t, "quantize");
  c->sensor[k].gain[0] = 1;
  if (c->n_signal > 1 || (!rounded && text_more(t))) {
    text_vector(t, "gain", c->sensor[k].gain, c->n_signal);
  }
  rounded = rounded || text_take(t, "quantize");
  c->sensor[k].step = rounded ? control_positive(t, "quantize") : 0;
  c->n_sensor++;
}

/* reference FUNCTION; of several signals reference SIGNAL FUNCTION; of attitude reference ATTITUDE */
static void scene_read_reference_of(text_file *t, scene *s, scene_control *c)
{
  fb_real quat[4];
  int k = 0;
  if (c->attitude.is) {
    text_once(t, &c->seen, "reference");
    model_attitude(t, c->attitude.wanted);
    scene_reals(quat, c->attitude.wanted, 4);
    if (!t->failed && fb_quat_normalize(quat) != FB_OK) {
      text_fail(t, "an attitude must not be zero");
    }
    for (int i = 0; i < 4; i++) {
      c->attitude.wanted[i] = (double)quat[i];
    }
    return;
  }
  if (c->n_signal > 1) {
    k = text_whole(t, "signal", 1, c->n_signal) - 1;
  }
  scene_once_numbered(t, &c->seen, "reference", k + 1);
  c->reference[k] = function_read(t, &s->tables, s->path);
}

/* turn X Y Z FUNCTION: what is wanted turns about this axis of its own by so many rad */
static void scene_read_turn(text_file *t, scene *s, scene_control *c)
{
  scene_attitude *const a = &c->attitude;
  double size;
  if (!a->is || a->n_turn == SCENE_TURNS) {
    text_fail(t, a->is ? "more than %d lines turn" : "turn is that of attitude, whose line stands before", SCENE_TURNS);
    return;
  }
  text_vector(t, "axis of a turn", a->turn[a->n_turn].axis, 3);
  size = hypot(hypot(a->turn[a->n_turn].axis[0], a->turn[a->n_turn].axis[1]), a->turn[a->n_turn].axis[2]);
  if (!t->failed && !(size > 0)) {
    text_fail(t, "the axis of a turn must not be zero");
  }
  for (int i = 0; i < 3; i++) {
    a->turn[a->n_turn].axis[i] /= size;
  }
  a->turn[a->n_turn++].f = function_read(t, &s->tables, s->path);
}

/* ---- shaped references */

#define SHAPE_MODES 4

/* A pair of delay in samples and factor, or more of one that is there. */
static void shape_add(double *to, int *n, double delay, double factor)
{
  int k = 0;
  while (k < *n && fabs(to[2 * k] - delay) > 0) {
    k++;
  }
  to[2 * k] = delay;
  to[2 * k + 1] = (k < *n ? to[2 * k + 1] : 0) + factor;
  *n += k == *n;
}

/* ZV of a mode: 1/(1 + K) now and K/(1 + K) half a period later, K = exp(-zeta pi / sqrt(1 - zeta^2)). What falls between
   two samples goes to both of them, so that it moves the mode as much, in both phases; the sum is 1. */
static void shape_of_mode(double pair[6], double w, double zeta, double T)
{
  const double own = w * sqrt(1 - zeta * zeta), late = function_pi / own, n = floor(late / T * (1 + 1e-12));
  const double part = fmax(0, late - n * T), K = exp(-zeta * w * late);
  const double grown = exp(zeta * w * part), b = exp(zeta * w * (part - T)) * sin(own * part) / sin(own * T);
  const double a = grown * cos(own * part) - b * exp(zeta * w * T) * cos(own * T), sum = 1 + K * (a + b);
  const double all[6] = {0, 1 / sum, n, K * a / sum, n + 1, K * b / sum};
  memcpy(pair, all, sizeof all);
}

/* shaper zv|zvd HZ ZETA [HZ ZETA ..] */
static void scene_read_shaper(text_file *t, scene *s, scene_control *c)
{
  static const char *const kinds[] = {"zv", "zvd", NULL};
  static double from[2 * CONTROL_NUMBERS], to[2 * CONTROL_NUMBERS];
  const int times = 1 + text_choice(t, "a shaper", kinds);
  int n = 1, modes = 0;
  if (!text_seen(&c->seen, "sample")) {
    text_fail(t, "sample must stand before the shaper");
  }
  from[0] = 0;
  from[1] = 1;
  do {
    const double w = 2 * function_pi * control_positive(t, "frequency in Hz");
    const double zeta = control_not_negative(t, "damping");
    double pair[6];
    if (!t->failed && (!(zeta < 1) || !(w * c->sample < function_pi))) {
      text_fail(t,
                zeta < 1 ? "%g Hz is not below half the frequency of the samples, %g Hz"
                         : "a mode of %g Hz and the damping %g does not swing: below 1",
                w / (2 * function_pi), zeta < 1 ? 0.5 / c->sample : zeta);
    }
    if (modes++ == SHAPE_MODES) {
      text_fail(t, "more than %d modes", SHAPE_MODES);
    }
    if (t->failed) {
      return;
    }
    shape_of_mode(pair, w, zeta, c->sample);
    for (int again = 0; again < times; again++) {
      int more = 0;
      for (int k = 0; k < 3 * n; k++) {
        shape_add(to, &more, from[2 * (k / 3)] + pair[2 * (k % 3)], from[2 * (k / 3) + 1] * pair[2 * (k % 3) + 1]);
      }
      n = more;
      memcpy(from, to, (size_t)(2 * n) * sizeof *from);
    }
  } while (text_more(t));
  if (s->numbers.n + 2 * n > CONTROL_NUMBERS) {
    text_fail(t, "more than %d numbers of matrices and shapers", CONTROL_NUMBERS);
    return;
  }
  for (int k = 0; k < n; k++) {
    c->shape_length = (int)fmax(c->shape_length, fmin(from[2 * k] + 1, SCENE_REMEMBERED));
  }
  if (c->shape_length == SCENE_REMEMBERED) {
    text_fail(t, "it shapes over more than %d samples: a faster mode, or a longer sample", SCENE_REMEMBERED - 1);
    return;
  }
  c->shape_first = s->numbers.n;
  c->n_shape = n;
  memcpy(s->numbers.x + s->numbers.n, from, (size_t)(2 * n) * sizeof *from);
  s->numbers.n += 2 * n;
}

/* ---- attitude */

enum { LAW_ORDER = 3, LAW_IN = 6, LAW_OUT = 3, LAW_A = 0, LAW_B = 9, LAW_C = 27, LAW_D = 36, LAW_SIZE = 54 };

/* attitude NODE: six signals, the error of attitude and of rate, which the block of the lines proportional, integral and
   derivative makes three of. */
static void scene_read_attitude(text_file *t, scene *s, scene_control *c)
{
  scene_attitude *const a = &c->attitude;
  control_block *const b = &c->block[0];
  if (c->n_block + c->n_sensor > 0 || text_seen(&c->seen, "signals") || scene_seen_numbered(&c->seen, "reference", 1) ||
      text_seen(&c->seen, "shaper")) {
    text_fail(t, "attitude stands before the other lines but sample and delay, without input and signals");
    return;
  }
  if (!text_seen(&c->seen, "sample")) {
    text_fail(t, "sample must stand before attitude");
  }
  if (s->numbers.n + LAW_SIZE > CONTROL_NUMBERS) {
    text_fail(t, "more than %d numbers of matrices", CONTROL_NUMBERS);
    return;
  }
  if (s->is_exact) {
    text_fail(t, "attitude is that of bodies: an exact beam has none");
  }
  a->is = 1;
  a->line = t->line;
  a->wanted[0] = 1;
  scene_read_node(t, s, &a->body, &a->node);
  a->gyro_body = a->body;
  a->gyro_node = a->node;
  c->n_signal = LAW_IN;
  memset(b, 0, sizeof *b);
  b->kind = CONTROL_LAW;
  b->line = t->line;
  b->n = LAW_ORDER;
  b->in = LAW_IN;
  b->out = LAW_OUT;
  b->first = s->numbers.n;
  memset(s->numbers.x + b->first, 0, LAW_SIZE * sizeof(double));
  s->numbers.n += LAW_SIZE;
  c->n_block = 1;
}

/* proportional, integral or derivative: a number, one for each axis, or nine of a matrix by rows.
   w = K_P e + K_I s + K_D r, s_k = s_{k-1} + T/2 (e_k + e_{k-1}) */
static void scene_read_law(text_file *t, scene *s, scene_control *c, const char *word)
{
  double x[9] = {0}, K[9] = {0}, *const law = s->numbers.x + c->block[0].first;
  const double T = c->sample;
  int n = 0;
  if (!c->attitude.is) {
    text_fail(t, "%s is that of attitude, whose line stands before", word);
    return;
  }
  while (text_more(t) && n < 9) {
    x[n++] = text_number(t, word);
  }
  if (n != 1 && n != 3 && n != 9) {
    text_fail(t, "%s wants 1 number, 3 of the axes or 9 of a matrix by rows, has %d", word, n);
  }
  for (int i = 0; i < 9; i++) {
    K[i] = n == 9 ? x[i] : i % 4 ? 0 : x[n == 3 ? i / 4 : 0];
  }
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      if (word[0] == 'p') {
        law[LAW_D + LAW_IN * i + j] += K[3 * i + j];
      } else if (word[0] == 'd') {
        law[LAW_D + LAW_IN * i + 3 + j] = K[3 * i + j];
      } else {
        law[LAW_A + 3 * i + j] = i == j;
        law[LAW_B + LAW_IN * i + j] = i == j ? T : 0;
        law[LAW_C + 3 * i + j] = K[3 * i + j];
        law[LAW_D + LAW_IN * i + j] += 0.5 * T * K[3 * i + j];
      }
    }
  }
}

/* ---- what goes out */

/* output motor|pull|load|rotor .., or allocation NAME [COMMAND] */
static void scene_read_actor(text_file *t, scene *s, scene_control *c)
{
  const int k = text_choice(t, "output of a controller", scene_actors);
  const char *name;
  if (scene_actors[k + 1]) {
    scene_allocation *const a = scene_begin_allocation(t, s, 1);
    scene_act *const act = a ? scene_read_act(t, s, (scene_actor)(k + SCENE_BY_MOTOR)) : NULL;
    if (act && !t->failed) {
      strcpy(c->unit, act->unit);
      c->allocation = s->n_allocation++;
      s->n_act++;
      a->n_act = 1;
    }
    return;
  }
  name = text_word(t);
  while (c->allocation < s->n_allocation && (!name || strcmp(s->allocation[c->allocation].name, name) != 0)) {
    c->allocation++;
  }
  if (c->allocation == s->n_allocation) {
    text_fail(t, "no allocation has the name %s", name ? name : "(missing)");
    return;
  }
  strcpy(c->unit, c->attitude.is ? "N m" : "-");
  c->to = text_more(t) ? text_whole(t, "command", 1, s->allocation[c->allocation].n) - 1 : -1;
}

/* Signals that come out of the blocks read so far. */
static int scene_signals(const scene_control *c)
{
  return c->n_block > 0 ? c->block[c->n_block - 1].out : c->n_signal;
}

static void scene_read_control_block(text_file *t, scene *s, scene_control *c, const char *word)
{
  control_block *const b = &c->block[c->n_block];
  const control_reading reading = {c->sample, scene_signals(c), s->path, &s->tables, &s->numbers};
  if (c->n_block == SCENE_BLOCKS) {
    text_fail(t, "more than %d blocks", SCENE_BLOCKS);
    return;
  }
  if (!text_seen(&c->seen, "sample") && control_word_of(word)) {
    text_fail(t, "sample must stand before the blocks");
  }
  if (!control_read_block(t, b, word, &reading)) {
    text_fail(t, "no such word for a controller: %s", word);
  }
  if (c->n_block > 0 && b[-1].kind >= CONTROL_THRUSTER) {
    text_fail(t, "nothing stands behind a thruster or pulse");
  }
  c->n_block++;
}

/* signals N */
static void scene_read_signals(text_file *t, const scene *s, scene_control *c)
{
  (void)s;
  if (c->n_block + c->n_sensor + c->attitude.is > 0 || scene_seen_numbered(&c->seen, "reference", 1)) {
    text_fail(t, "signals stands before what comes in, and not beside attitude");
  }
  c->n_signal = text_whole(t, "number of signals", 1, CONTROL_SIGNALS);
}

static void scene_read_gyro(text_file *t, scene *s, scene_control *c)
{
  if (!c->attitude.is) {
    text_fail(t, "gyro is that of attitude, whose line stands before");
  }
  scene_read_node(t, s, &c->attitude.gyro_body, &c->attitude.gyro_node);
}

static void scene_read_control_line(text_file *t, scene *s, scene_control *c, const char *word)
{
  static const char *const once[] = {"sample",       "delay",    "signals",    "attitude", "gyro",
                                     "proportional", "integral", "derivative", "shaper",   "output"};
  for (int k = 0; k < (int)(sizeof once / sizeof *once); k++) {
    if (strcmp(word, once[k]) == 0) {
      text_once(t, &c->seen, word);
    }
  }
  if (strcmp(word, "input") == 0) {
    scene_read_sensor(t, s, c);
  } else if (strcmp(word, "sample") == 0) {
    c->sample = control_positive(t, "sample");
  } else if (strcmp(word, "delay") == 0) {
    c->delay = control_not_negative(t, "delay");
  } else if (strcmp(word, "signals") == 0) {
    scene_read_signals(t, s, c);
  } else if (strcmp(word, "attitude") == 0) {
    scene_read_attitude(t, s, c);
  } else if (strcmp(word, "gyro") == 0) {
    scene_read_gyro(t, s, c);
  } else if (strcmp(word, "turn") == 0) {
    scene_read_turn(t, s, c);
  } else if (strcmp(word, "proportional") == 0 || strcmp(word, "integral") == 0 || strcmp(word, "derivative") == 0) {
    scene_read_law(t, s, c, word);
  } else if (strcmp(word, "reference") == 0) {
    scene_read_reference_of(t, s, c);
  } else if (strcmp(word, "shaper") == 0) {
    scene_read_shaper(t, s, c);
  } else if (strcmp(word, "output") == 0) {
    scene_read_actor(t, s, c);
  } else {
    scene_read_control_block(t, s, c, word);
  }
  text_end_of_line(t);
}

/* As many commands as the allocation takes, or the one that is named. */
static void scene_check_output(text_file *t, const scene *s, scene_control *c)
{
  const scene_allocation *const a = &s->allocation[c->allocation];
  const int n = c->to < 0 ? a->n : 1;
  c->n_command = scene_signals(c);
  if (c->n_command != n) {
    t->line = text_seen(&c->seen, "output");
    text_fail(t, "controller %s makes %d commands, its output takes %d", c->name, c->n_command, n);
  }
  c->to = c->to < 0 ? 0 : c->to;
}

/* What is missing, at the line of the controller. */
static void scene_check_control(text_file *t, const scene *s, scene_control *c)
{
  int commands = 0;
  if (!text_seen(&c->seen, "sample")) {
    text_fail(t, "controller %s has no sample: its instants are at multiples of it", c->name);
  }
  if (c->n_sensor == 0 && !c->attitude.is && !text_seen(&c->seen, "shaper")) {
    text_fail(t, "controller %s has no input", c->name);
  }
  if (c->n_block == 0) {
    text_fail(t, "controller %s has no block", c->name);
  }
  if (c->attitude.is && !text_seen(&c->seen, "proportional") && !text_seen(&c->seen, "derivative")) {
    text_fail(t, "controller %s of attitude has neither proportional nor derivative", c->name);
  }
  if (text_seen(&c->seen, "output") == 0) {
    text_fail(t, "controller %s has no output", c->name);
  }
  if (c->delay > SCENE_LATE * c->sample) {
    text_fail(t, "controller %s: a delay of %g s is more than %d samples", c->name, c->delay, SCENE_LATE);
  }
  if (!t->failed) {
    scene_check_output(t, s, c);
  }
  for (int k = 0; k <= s->n_control; k++) {
    commands += s->control[k].n_command;
  }
  if (commands > SCENE_COMMANDS) {
    text_fail(t, "more than %d commands of all controllers", SCENE_COMMANDS);
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
  c->n_signal = 1;
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
  scene_check_control(t, s, c);
  if (!t->failed) {
    t->line = last;
  }
  s->n_control += !t->failed;
}
#endif
