/* scene_wanted.h - reads what is wanted of a scene: outputs, measures, and what they are compared with. See scene.h. */
#ifndef SCENE_WANTED_H
#define SCENE_WANTED_H
#include "scene_exact.h"
#include "scene_rotor.h"

static void scene_read_gauge_name(text_file *t, const scene *s, scene_output *output)
{
  char part[TEXT_NAME];
  output->body = scene_read_body_name(t, s, part);
  for (int k = 0; k < s->body[output->body].n_gauge; k++) {
    if (strcmp(s->body[output->body].gauge_name[k], part) == 0) {
      output->at = k;
      return;
    }
  }
  text_fail(t, "body %s has no gauge %s", s->body[output->body].name, part);
}

/* The unit in SI, m and N replaced by those of the scene. */
static void scene_unit(const scene *s, scene_output *output, const char *unit)
{
  size_t n = 0;
  if (strcmp(s->length_unit, "m") == 0 && strcmp(s->force_unit, "N") == 0) {
    snprintf(output->unit, sizeof output->unit, "%s", unit); /* J and W as they are */
    return;
  }
  output->unit[0] = 0;
  for (const char *p = unit; *p && n + 16 < sizeof output->unit; p++) {
    const int alone = (p == unit || !isalpha((unsigned char)p[-1])) && !isalpha((unsigned char)p[1]);
    const char one[2] = {*p, 0}, *const length = s->length_unit, *const force = s->force_unit;
    n += (size_t)(alone && *p == 'J'   ? sprintf(output->unit + n, "%s %s", force, length)
                  : alone && *p == 'W' ? sprintf(output->unit + n, "%s %s/s", force, length)
                                       : sprintf(output->unit + n, "%s",
                                                 !alone      ? one
                                                 : *p == 'm' ? length
                                                 : *p == 'N' ? force
                                                             : one));
  }
}

/* units LENGTH FORCE: names, for headers */
static void scene_read_units(text_file *t, scene *s)
{
  const char *const length = text_word(t), *const force = text_word(t);
  if (!force || strlen(length) >= sizeof s->length_unit || strlen(force) >= sizeof s->force_unit) {
    text_fail(t, "units wants a name for the unit of length and one for that of force, %d characters at most",
              (int)sizeof s->length_unit - 1);
    return;
  }
  if (strpbrk(length, "<>&") || strpbrk(force, "<>&")) {
    text_fail(t, "a unit has none of < > &");
  }
  if (s->n_output > 0) {
    text_fail(t, "units must stand before the outputs");
  }
  strcpy(s->length_unit, length);
  strcpy(s->force_unit, force);
}

/* Of an axis that slides. */
static void scene_axis_unit(const scene *s, scene_output *output)
{
  static const char *const units[] = {"m", "m/s", "m/s^2", "N"};
  if (scene_axis_slides(&s->joint[output->at], output->axis)) {
    scene_unit(s, output, units[output->quantity - SCENE_COORDINATE]);
  }
  if (scene_axes(&s->joint[output->at]) == 6 && output->axis > 2 && output->quantity == SCENE_COORDINATE) {
    scene_unit(s, output, "-");
  }
}

/* Refuses a name that another output has. */
static void scene_new_output(text_file *t, const scene *s, const char *label)
{
  if (strcmp(label, "t") == 0) {
    text_fail(t, "t is the column of the time: no name of an output");
  }
  for (int k = 0; k < s->n_output; k++) {
    if (strcmp(s->output[k].label, label) == 0) {
      text_fail(t, "two outputs have the name %s", label);
    }
  }
  if (s->n_output == SCENE_OUTPUTS) {
    text_fail(t, "more than %d outputs", SCENE_OUTPUTS);
  }
}

static int scene_control_of(text_file *t, const scene *s)
{
  const char *const word = text_word(t);
  for (int k = 0; k < s->n_control && word; k++) {
    if (strcmp(s->control[k].name, word) == 0) {
      return k;
    }
  }
  text_fail(t, "no controller has the name %s", word ? word : "(missing)");
  return 0;
}

/* allocation NAME: its number */
static int scene_allocation_of(text_file *t, const scene *s)
{
  const char *const word = text_word(t);
  for (int k = 0; k < s->n_allocation && word; k++) {
    if (s->allocation[k].name[0] && strcmp(s->allocation[k].name, word) == 0) {
      return k;
    }
  }
  text_fail(t, "no allocation has the name %s", word ? word : "(missing)");
  return 0;
}

/* Node, body, mode, gauge, or joint with its axis. */
static void scene_read_where(text_file *t, const scene *s, scene_output *output)
{
  switch (scene_quantities[output->quantity].place) {
  case SCENE_AT_NODE:
    scene_read_node(t, s, &output->body, &output->at);
    break;
  case SCENE_AT_BODY:
    output->body = scene_read_whole_body(t, s);
    break;
  case SCENE_AT_MODE:
    output->body = scene_read_whole_body(t, s);
    if (s->body[output->body].shape.n == 0) {
      text_fail(t, "body %s has no modes", s->body[output->body].name);
    }
    output->at = text_whole(t, "mode", 1, s->body[output->body].shape.n) - 1;
    break;
  case SCENE_AT_GAUGE:
    scene_read_gauge_name(t, s, output);
    break;
  case SCENE_AT_JOINT:
    output->at = scene_joint_of(t, s);
    break;
  case SCENE_AT_AXIS:
    output->at = scene_joint_of(t, s);
    output->axis = t->failed ? 0 : scene_read_axis(t, &s->joint[output->at]);
    scene_axis_unit(s, output);
    if (output->quantity == SCENE_COORDINATE_ACCELERATION && s->joint[output->at].loop) {
      text_fail(t, "a loop has no joint_acceleration");
    }
    break;
  case SCENE_AT_SPRING:
    output->at = scene_spring_of(t, s);
    break;
  case SCENE_AT_ROTOR:
    output->at = scene_rotor_of(t, s);
    output->body = t->failed ? 0 : s->rotor[output->at].body;
    break;
  case SCENE_AT_CONTROL:
    output->at = scene_control_of(t, s);
    scene_unit(s, output, s->control[output->at].unit);
    break;
  case SCENE_AT_ALLOCATION:
    output->at = scene_allocation_of(t, s);
    break;
  default:
    break;
  }
}

/* One output for each axis: NAME_x, ... */
static void scene_add_axes(text_file *t, scene *s, const scene_output *output)
{
  const char *const *axes = scene_quantities[output->quantity].axes;
  for (int k = 0; axes[k] && !t->failed; k++) {
    scene_output one = *output;
    one.axis = k;
    if (snprintf(one.label, sizeof one.label, "%s_%s", output->label, axes[k]) >= (int)sizeof one.label) {
      text_fail(t, "the name is too long: %s", output->label);
    }
    scene_new_output(t, s, one.label);
    if (!t->failed) {
      s->output[s->n_output++] = one;
    }
  }
}

/* Of a controller or an allocation: the command or actuator of that number, or an output NAME_1, ... for each. */
static void scene_add_numbered(text_file *t, scene *s, const scene_output *output)
{
  const int allocated = output->quantity == SCENE_ALLOCATED;
  const scene_allocation *const a = &s->allocation[output->at];
  const int n = allocated ? a->n_act : s->control[output->at].n_command, one = n == 1 || text_more(t);
  const int first = text_more(t) ? text_whole(t, allocated ? "actuator" : "command", 1, n) - 1 : 0;
  for (int k = first; k < (one ? first + 1 : n) && !t->failed; k++) {
    scene_output *const to = &s->output[s->n_output];
    char label[TEXT_NAME];
    if (snprintf(label, sizeof label, one ? "%s" : "%s_%d", output->label, k + 1) >= (int)sizeof label) {
      text_fail(t, "the name is too long: %s", output->label);
    }
    scene_new_output(t, s, label);
    if (t->failed) {
      return;
    }
    *to = *output;
    strcpy(to->label, label);
    if (allocated) {
      to->at = a->first + k;
      scene_unit(s, to, s->act[to->at].unit);
    } else {
      to->axis = k;
    }
    s->n_output++;
  }
}

static int scene_is_internal(const scene_output *output)
{
  return output->quantity == SCENE_INTERNAL_FORCE || output->quantity == SCENE_INTERNAL_MOMENT;
}

/* output LABEL QUANTITY PLACE [AXIS] */
static void scene_read_output(text_file *t, scene *s)
{
  const char *names[SCENE_QUANTITIES + 1] = {NULL};
  scene_output output;
  memset(&output, 0, sizeof output);
  for (int k = 0; k < SCENE_QUANTITIES; k++) {
    names[k] = scene_quantities[k].name;
  }
  text_name(t, "an output", output.label);
  scene_new_output(t, s, output.label);
  output.quantity = (scene_quantity)text_choice(t, "an output", names);
  if (s->is_exact && !exact_has(output.quantity)) {
    text_fail(t, "an exact beam has no output %s", names[output.quantity]);
  }
  scene_unit(s, &output, scene_quantities[output.quantity].unit);
  scene_read_where(t, s, &output);
  if (scene_is_internal(&output) && !s->is_exact && !t->failed &&
      (s->body[output.body].kind != MODEL_BEAM || output.at == 0)) {
    text_fail(t, "%s is of nodes on beams (at an origin: reaction_force, reaction_torque)", names[output.quantity]);
  }
  if (output.quantity == SCENE_COMMAND || output.quantity == SCENE_ALLOCATED) {
    scene_add_numbered(t, s, &output);
  } else if (scene_quantities[output.quantity].axes[0] && !text_more(t)) {
    scene_add_axes(t, s, &output);
  } else if (!t->failed) {
    if (scene_quantities[output.quantity].axes[0]) {
      output.axis = text_choice(t, "the axis", scene_quantities[output.quantity].axes);
    }
    s->output[s->n_output++] = output;
  }
}

/* Where none is asked for: displacements of the last node of what bends, positions of what does not, joints. */
static void scene_default_outputs(text_file *t, scene *s)
{
  for (int k = 0; k < s->n_body && !t->failed; k++) {
    const scene_body *const b = &s->body[k];
    scene_output output;
    memset(&output, 0, sizeof output);
    output.body = k;
    output.at = b->n_node - 1;
    output.quantity = (b->shape.n > 0 || s->is_exact) && b->n_node > 1 ? SCENE_DISPLACEMENT : SCENE_POSITION;
    scene_unit(s, &output, scene_quantities[output.quantity].unit);
    snprintf(output.label, sizeof output.label, "%.28s", b->name);
    scene_add_axes(t, s, &output);
  }
  for (int k = 0; k < s->n_joint && !t->failed; k++) {
    for (int axis = 0; axis < scene_axes(&s->joint[k]) && scene_axes(&s->joint[k]) < 3; axis++) {
      scene_output output;
      memset(&output, 0, sizeof output);
      output.quantity = SCENE_COORDINATE;
      output.at = k;
      output.axis = axis;
      scene_unit(s, &output, scene_quantities[SCENE_COORDINATE].unit);
      scene_axis_unit(s, &output);
      snprintf(output.label, sizeof output.label, "%.20s_%d", s->joint[k].name, axis + 1);
      scene_new_output(t, s, output.label);
      if (!t->failed) {
        s->output[s->n_output++] = output;
      }
    }
  }
}

/* No output has that name: perhaps it is a vector, whose components have. */
static void scene_no_output(text_file *t, const scene *s, const char *word)
{
  const size_t n = strlen(word);
  char components[4 * TEXT_NAME] = "";
  for (int k = 0; k < s->n_output; k++) {
    const char *const label = s->output[k].label, *const *axes = scene_quantities[s->output[k].quantity].axes;
    if (strlen(label) > n && strncmp(label, word, n) == 0 && label[n] == '_') {
      for (; *axes; axes++) {
        if (strcmp(label + n + 1, *axes) == 0 && strlen(components) + strlen(label) + 2 < sizeof components) {
          strcat(strcat(components, " "), label);
        }
      }
    }
  }
  text_fail(t, "no output has the name %s%s%s", word, components[0] ? ": of its components take" : "", components);
}

static int scene_output_of(text_file *t, const scene *s)
{
  const char *const word = text_word(t);
  for (int k = 0; k < s->n_output && word; k++) {
    if (strcmp(s->output[k].label, word) == 0) {
      return k;
    }
  }
  scene_no_output(t, s, word ? word : "(missing)");
  return 0;
}

/* The next word must be this one. */
static void scene_expect(text_file *t, const char *what)
{
  const char *const word = text_word(t);
  if (!word || strcmp(word, what) != 0) {
    text_fail(t, "expected %s, is %s", what, word ? word : "missing");
  }
}

/* Is there a body or a joint of that name? */
static int scene_has_part(const scene *s, const char *name)
{
  for (int k = 0; k < s->n_body; k++) {
    if (strcmp(s->body[k].name, name) == 0) {
      return 1;
    }
  }
  for (int k = 0; k < s->n_joint; k++) {
    if (strcmp(s->joint[k].name, name) == 0) {
      return 1;
    }
  }
  return 0;
}

/* near W, in BODY [N], in JOINT [N], or the name of a mode: flap 2. 0: it is a number. */
static int scene_read_mode(text_file *t, scene *s, scene_measure *measure)
{
  const char *const next = t->at + strspn(t->at, " ");
  const char *word;
  size_t n = 0;
  if (!*next || strchr("0123456789+-.$", *next)) {
    return 0;
  }
  if (text_take(t, "near")) {
    measure->near = text_number(t, "frequency that is near [rad/s]");
    if (!t->failed && !(measure->near > 0)) {
      text_fail(t, "the frequency that is near must be greater than 0 rad/s");
    }
    return 1;
  }
  if (text_take(t, "in")) {
    word = text_word(t);
    snprintf(measure->part, sizeof measure->part, "%s", word ? word : "");
    if (!scene_has_part(s, measure->part)) {
      text_fail(t, "no body and no joint has the name %s", word ? word : "(missing)");
    }
    measure->output = text_more(t) ? text_whole(t, "number of the mode", 1, FB_MAX_LINEAR) - 1 : 0;
    return 1;
  }
  while ((word = text_more(t) ? text_word(t) : NULL) != NULL && n < sizeof measure->mode) {
    n += (size_t)snprintf(measure->mode + n, sizeof measure->mode - n, "%s%s", n ? " " : "", word);
  }
  return 1;
}

/* measure LABEL max|min|mean|rms|final OUTPUT [after T] */
static void scene_read_measure(text_file *t, scene *s)
{
  scene_measure *const measure = &s->measure[s->n_measure];
  if (s->n_measure == SCENE_MEASURES) {
    text_fail(t, "more than %d measures", SCENE_MEASURES);
    return;
  }
  measure->line = t->line;
  text_name(t, "a measure", measure->label);
  for (int k = 0; k < s->n_measure; k++) {
    if (strcmp(s->measure[k].label, measure->label) == 0) {
      text_fail(t, "two measures have the name %s", measure->label);
    }
  }
  measure->kind = (scene_kind)text_choice(t, "a measure", scene_kinds);
  if (measure->kind >= SCENE_GAIN_MARGIN) {
    measure->output = scene_control_of(t, s);
    if (measure->kind < SCENE_POLE_RADIUS && text_more(t)) {
      measure->command = text_whole(t, "command", 1, s->control[measure->output].n_command);
    }
    s->n_measure++;
    return;
  }
  if (measure->kind == SCENE_FREQUENCY && scene_read_mode(t, s, measure)) {
    s->n_measure++;
    return;
  }
  if (measure->kind >= SCENE_FREQUENCY) {
    measure->output = text_whole(t, "number of the mode", 1, FB_MAX_LINEAR) - 1;
    s->n_measure++;
    return;
  }
  measure->output = scene_output_of(t, s);
  if (text_more(t)) {
    scene_expect(t, "after");
    measure->after = text_number(t, "time");
  }
  s->n_measure++;
}

/* X [relative], behind the word tolerance */
static double scene_read_tolerance(text_file *t, int *relative)
{
  const double tolerance = text_number(t, "tolerance");
  *relative = text_more(t);
  if (*relative) {
    scene_expect(t, "relative");
  }
  if (!t->failed && !(tolerance > 0)) {
    text_fail(t, "a tolerance must be greater than 0");
  }
  return tolerance;
}

/* expect MEASURE VALUE tolerance X [relative] */
static void scene_read_expectation(text_file *t, scene *s)
{
  scene_expectation *const e = &s->expectation[s->n_expectation];
  const char *const word = text_word(t);
  if (s->n_expectation == SCENE_MEASURES) {
    text_fail(t, "more than %d expectations", SCENE_MEASURES);
    return;
  }
  e->line = t->line;
  while (e->measure < s->n_measure && word && strcmp(s->measure[e->measure].label, word) != 0) {
    e->measure++;
  }
  if (!word || e->measure == s->n_measure) {
    text_fail(t, "no measure has the name %s", word ? word : "(missing)");
  }
  e->value = text_number(t, "value");
  scene_expect(t, "tolerance");
  e->tolerance = scene_read_tolerance(t, &e->relative);
  s->n_expectation++;
}

/* reference FILE TIME_COLUMN COLUMN output LABEL [factor X] [from T] [to T] tolerance X [relative] */
static void scene_read_reference(text_file *t, scene *s)
{
  static const char *const words[] = {"factor", "from", "to", "tolerance", NULL};
  scene_reference *const r = &s->reference[s->n_reference];
  text_words seen = {0};
  int k = 0;
  if (s->n_reference == SCENE_OUTPUTS) {
    text_fail(t, "more than %d references", SCENE_OUTPUTS);
    return;
  }
  r->line = t->line;
  r->factor = 1;
  r->from = -HUGE_VAL;
  r->to = HUGE_VAL;
  r->table.first = s->tables.n;
  function_read_columns(t, &r->table, &s->tables, s->path);
  scene_expect(t, "output");
  r->output = t->failed ? 0 : scene_output_of(t, s);
  for (k = text_choice(t, "a reference", words); k < 3 && !t->failed; k = text_choice(t, "a reference", words)) {
    text_once(t, &seen, words[k]);
    *(k == 0 ? &r->factor : k == 1 ? &r->from : &r->to) = text_number(t, words[k]);
  }
  r->tolerance = scene_read_tolerance(t, &r->relative);
  s->n_reference++;
}
#endif
