/* scene_joint.h - reads joints, loops and events of a scene. See scene.h. */
#ifndef SCENE_JOINT_H
#define SCENE_JOINT_H
#include "scene_body.h"

/* Kinds of joints by fb_joint_kind: their words; their axes, of a free one its speeds; the first and the number of
   those whose unit is m; whether the child moves along the joint. */
static const char *const scene_joint_words[] = {"free",  "rigid",     "revolute",  "prismatic", "cylindrical",
                                                "screw", "universal", "spherical", NULL};
static const struct {
  int axes, slide, slides, moves;
} scene_joint_kinds[] = {{6, 0, 3, 0}, {0, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 1, 1},
                         {2, 1, 1, 1}, {1, 0, 0, 1}, {2, 0, 0, 0}, {3, 0, 0, 0}};
typedef char scene_joint_kinds_are_whole[sizeof scene_joint_kinds / sizeof scene_joint_kinds[0] == FB_JOINT_COUNT &&
                                                 sizeof scene_joint_words / sizeof(char *) == FB_JOINT_COUNT + 1
                                             ? 1
                                             : -1];

static int scene_axes(const scene_joint *joint)
{
  return scene_joint_kinds[joint->desc.kind].axes;
}

static int scene_read_axis(text_file *t, const scene_joint *joint)
{
  const int axes = scene_axes(joint);
  if (axes == 0) {
    text_fail(t, "joint %s has no axis", joint->name);
    return 0;
  }
  return text_whole(t, "number of the axis", 1, axes) - 1;
}

/* Is the unit of the axis m? */
static int scene_axis_slides(const scene_joint *joint, int axis)
{
  const int slide = scene_joint_kinds[joint->desc.kind].slide;
  return axis >= slide && axis < slide + scene_joint_kinds[joint->desc.kind].slides;
}

static int scene_joint_of(text_file *t, const scene *s)
{
  const char *const word = text_word(t);
  for (int k = 0; k < s->n_joint && word; k++) {
    if (strcmp(s->joint[k].name, word) == 0) {
      return k;
    }
  }
  text_fail(t, "no joint has the name %s", word ? word : "(missing)");
  return 0;
}

/* Shortest rotation that takes the z axis to the direction z; half a turn about x where that is opposite. */
static void scene_align(fb_real quat[4], const double z[3])
{
  const double across = hypot(z[0], z[1]), angle = atan2(across, z[2]);
  const fb_real turn[3] = {(fb_real)(across > 0 ? -z[1] / across * angle : angle),
                           (fb_real)(across > 0 ? z[0] / across * angle : 0), 0};
  fb_quat_from_rotvec(quat, turn);
}

/* axis X Y Z [X Y Z]: z of the joint frame in the child's axes, and where its x points to. */
static void scene_read_joint_axis(text_file *t, scene_joint *joint)
{
  fb_real *const quat = joint->desc.child_attitude;
  double z[3], x[3];
  text_vector(t, "axis", z, 3);
  if (!t->failed && !(fabs(z[0]) + fabs(z[1]) + fabs(z[2]) > 0)) {
    text_fail(t, "the axis of a joint must not be zero");
  }
  scene_align(quat, z);
  if (text_more(t)) {
    fb_real R[9], roll[3] = {0, 0, 0}, about[4], aligned[4];
    double along = 0, across = 0;
    text_vector(t, "second axis", x, 3);
    fb_quat_to_mat33(R, quat);
    for (int i = 0; i < 3; i++) {
      along += (double)R[3 * i] * x[i];
      across += (double)R[3 * i + 1] * x[i];
    }
    if (!t->failed && !(fabs(along) + fabs(across) > 0)) {
      text_fail(t, "the second axis of a joint must be across the first");
    }
    roll[2] = (fb_real)atan2(across, along);
    fb_quat_from_rotvec(about, roll);
    memcpy(aligned, quat, sizeof aligned);
    fb_quat_mul(quat, aligned, about);
  }
}

static void scene_read_modes(text_file *t, scene_joint *joint)
{
  static const char *const modes[] = {"free", "locked", "prescribed", NULL};
  const int axes = scene_axes(joint);
  int n = 0;
  do {
    if (n == (axes < 3 ? axes : 1)) {
      text_fail(t,
                axes < 3 ? "joint %s has one mode for each axis: %d at most"
                         : "joint %s has one mode for all its axes: %d",
                joint->name, axes < 3 ? axes : 1);
      return;
    }
    joint->desc.mode[n++] = (fb_axis_mode)text_choice(t, "mode of an axis", modes);
  } while (text_more(t));
}

static void scene_read_drive(text_file *t, scene *s, const char *word)
{
  scene_joint *const joint = &s->joint[s->n_joint];
  scene_drive *const drive = &s->drive[s->n_drive];
  if (s->n_drive == SCENE_DRIVES) {
    text_fail(t, "more than %d drives", SCENE_DRIVES);
    return;
  }
  drive->line = t->line;
  drive->kind = word[0] == 'm' ? SCENE_MOTOR : word[0] == 'v' ? SCENE_VALUE : SCENE_SPEED;
  drive->joint = s->n_joint;
  drive->act = -1;
  drive->axis = scene_read_axis(t, joint);
  drive->f = function_read(t, &s->tables, s->path);
  if (drive->kind == SCENE_MOTOR ? scene_axes(joint) > 3 : drive->kind == SCENE_VALUE && scene_axes(joint) > 2) {
    text_fail(t, drive->kind == SCENE_MOTOR ? "a free joint has no motors: use load"
                                            : "spherical and free joints are prescribed by their rate");
  }
  if (drive->kind != SCENE_MOTOR) {
    joint->desc.mode[scene_axes(joint) > 2 ? 0 : drive->axis] = FB_AXIS_PRESCRIBED;
  }
  s->n_drive++;
}

/* Words that place and turn a joint's frame; a free one has none. */
static int scene_read_frame(text_file *t, scene_joint *joint, const char *word)
{
  fb_joint_desc *const d = &joint->desc;
  if (strcmp(word, "position") == 0) {
    text_reals(t, word, d->position, 3);
  } else if (strcmp(word, "child_position") == 0) {
    text_reals(t, word, d->child_position, 3);
  } else if (strcmp(word, "attitude") == 0) {
    model_attitude(t, joint->orientation);
  } else if (strcmp(word, "axis") == 0) {
    scene_read_joint_axis(t, joint);
  } else {
    return 0;
  }
  if (d->kind == FB_JOINT_FREE) {
    text_fail(t, "%s of a free joint: give its body start_position or start_attitude", word);
  }
  return 1;
}

/* The joint that a body hangs by; NULL: it is free. */
static const scene_joint *scene_joint_under(const scene *s, int body)
{
  for (int k = 0; k < s->n_joint; k++) {
    if (!s->joint[k].loop && s->joint[k].desc.child == body) {
      return &s->joint[k];
    }
  }
  return NULL;
}

static int scene_has_drive(const scene *s, int joint, int axis, scene_drive_kind kind)
{
  int k = 0;
  while (k < s->n_drive && (s->drive[k].joint != joint || s->drive[k].axis != axis || s->drive[k].kind != kind)) {
    k++;
  }
  return k < s->n_drive;
}

/* Numbers of the axes, which are at most so many. */
static void scene_read_axes(text_file *t, const scene_joint *joint, const char *word, fb_real *x, int most)
{
  const int axes = scene_axes(joint), n = axes == 3 ? 1 : axes > most ? 0 : axes;
  double value[6] = {0};
  if (n == 0) {
    text_fail(t, "%s of a joint that has no axis for it", word);
    return;
  }
  text_vector(t, word, value, n);
  for (int i = 0; i < n; i++) {
    x[i] = (fb_real)value[i];
    if (value[i] < 0 && strcmp(word, "rest") != 0) {
      text_fail(t, "%s is negative", word);
    }
  }
}

/* stops AXIS LOW HIGH stiffness K [loss C] */
static void scene_read_stops(text_file *t, scene_joint *joint)
{
  fb_joint_desc *const d = &joint->desc;
  const int axis = scene_read_axis(t, joint);
  if (t->failed) {
    return;
  }
  if (d->kind == FB_JOINT_FREE || d->kind == FB_JOINT_SPHERICAL) {
    text_fail(t, "stops of a spherical or free joint");
    return;
  }
  scene_once_numbered(t, &joint->seen, "stops", axis + 1);
  d->stop[axis][0] = (fb_real)text_number(t, "lowest value");
  d->stop[axis][1] = (fb_real)text_number(t, "highest value");
  if (!t->failed && !(d->stop[axis][0] < d->stop[axis][1])) {
    text_fail(t, "the lower stop comes first");
  }
  if (!text_take(t, "stiffness")) {
    text_fail(t, "stops end in: stiffness K, maybe loss C");
    return;
  }
  d->stop_stiffness[axis] = (fb_real)text_number(t, "stiffness");
  if (!t->failed && !(d->stop_stiffness[axis] > 0)) {
    text_fail(t, "the stiffness of stops must be positive");
  }
  if (text_take(t, "loss")) {
    d->stop_loss[axis] = (fb_real)text_number(t, "loss");
    if (!t->failed && d->stop_loss[axis] < 0) {
      text_fail(t, "the loss of stops must not be negative");
    }
  }
}

static void scene_read_joint_line(text_file *t, scene *s, const char *word)
{
  scene_joint *const joint = &s->joint[s->n_joint];
  fb_joint_desc *const d = &joint->desc;
  const int many = strcmp(word, "motor") == 0 || strcmp(word, "value") == 0 || strcmp(word, "rate") == 0;
  if (!many && strcmp(word, "start") != 0 && strcmp(word, "stops") != 0) {
    text_once(t, &joint->seen, word);
  }
  if (scene_read_frame(t, joint, word)) {
    text_end_of_line(t);
    return;
  }
  if (strcmp(word, "pitch") == 0) {
    if (d->kind != FB_JOINT_SCREW) {
      text_fail(t, "pitch is that of a screw");
    }
    d->pitch = (fb_real)text_number(t, word);
  } else if (strcmp(word, "stiffness") == 0) {
    scene_read_axes(t, joint, word, d->stiffness, 6);
  } else if (strcmp(word, "rest") == 0) {
    if (d->kind == FB_JOINT_SPHERICAL) {
      text_fail(t, "the spring of a spherical joint rests at zero: turn the joint by attitude");
    }
    scene_read_axes(t, joint, word, d->rest, 6);
  } else if (strcmp(word, "damping") == 0) {
    scene_read_axes(t, joint, word, d->damping, 6);
  } else if (strcmp(word, "friction") == 0) {
    scene_read_axes(t, joint, word, d->friction, 3);
  } else if (strcmp(word, "friction_speed") == 0) {
    scene_read_axes(t, joint, word, d->friction_speed, 3);
  } else if (strcmp(word, "stops") == 0) {
    scene_read_stops(t, joint);
  } else if (strcmp(word, "mode") == 0) {
    scene_read_modes(t, joint);
  } else if (many) {
    scene_read_drive(t, s, word);
  } else if (strcmp(word, "start") == 0) {
    const int axis = scene_read_axis(t, joint);
    const double value = text_number(t, "value");
    scene_once_numbered(t, &joint->seen, word, axis + 1);
    if (joint->loop) {
      text_fail(t, "a loop follows the joints of the tree: start those");
    }
    if (axis > 2 || scene_axes(joint) > 2) {
      text_fail(t, "spherical and free joints start with the start_ words of their body");
      return;
    }
    joint->start[axis] = value;
    if (text_more(t)) {
      scene_once_numbered(t, &joint->seen, "speed", axis + 1);
      joint->speed[axis] = text_number(t, "speed");
    }
  } else {
    text_fail(t, "no such word for a joint: %s", word);
    return;
  }
  text_end_of_line(t);
}

/* The joint's ends: PARENT[.NODE]|ground CHILD[.NODE]; sees that the tree is one. */
static void scene_read_ends(text_file *t, scene *s, scene_joint *joint, int loop)
{
  fb_joint_desc *const d = &joint->desc;
  if (text_take(t, "ground")) {
    d->parent = FB_GROUND;
  } else {
    scene_read_node(t, s, &d->parent, &d->parent_node);
  }
  scene_read_node(t, s, &d->child, &d->child_node);
  if (t->failed) {
    return;
  }
  joint->at = loop ? s->n_loop : d->child; /* loops: see scene_check */
  if (d->kind == FB_JOINT_FREE && (loop || d->parent != FB_GROUND)) {
    text_fail(t, loop ? "a free joint closes no loop" : "a free joint is one to ground");
  }
  if (!loop && d->child_node != 0) {
    text_fail(t, "a body hangs by its origin: give child_position, or a loop to a node");
  } else if (!loop && d->parent >= d->child) {
    text_fail(t, "body %s hangs on %s, which must stand before it", s->body[d->child].name, s->body[d->parent].name);
  }
  for (int k = 0; k < s->n_joint && !loop; k++) {
    if (!s->joint[k].loop && s->joint[k].at == joint->at) {
      text_fail(t, "body %s hangs by %s already: further joints are loops", s->body[d->child].name, s->joint[k].name);
    }
  }
}

static void scene_read_any_joint(text_file *t, scene *s, int loop)
{
  scene_joint *const joint = &s->joint[s->n_joint];
  if (loop ? s->n_loop == FB_MAX_LOOPS : s->n_joint == SCENE_JOINTS) {
    text_fail(t, "more than %d %s", loop ? FB_MAX_LOOPS : FB_MAX_BODIES, loop ? "loops" : "joints");
    return;
  }
  memset(joint, 0, sizeof *joint);
  joint->loop = loop;
  joint->line = t->line;
  joint->orientation[0] = 1;
  joint->desc.child_attitude[0] = FB_R(1.0);
  text_name(t, "a joint", joint->name);
  for (int k = 0; k < s->n_joint; k++) {
    if (strcmp(s->joint[k].name, joint->name) == 0) {
      text_fail(t, "two joints have the name %s", joint->name);
    }
  }
  joint->desc.kind = (fb_joint_kind)text_choice(t, "a joint", scene_joint_words);
  scene_read_ends(t, s, joint, loop);
  text_end_of_line(t);
  text_begin(t, loop ? "loop" : "joint", joint->name);
  while (text_within(t)) {
    scene_read_joint_line(t, s, text_word(t));
  }
  { /* orientation = parent's attitude . child's turned back */
    fb_real orientation[4];
    for (int i = 0; i < 4; i++) {
      orientation[i] = (fb_real)joint->orientation[i];
    }
    fb_quat_normalize(orientation);
    fb_quat_mul(joint->desc.attitude, orientation, joint->desc.child_attitude);
  }
  s->n_joint++;
  s->n_loop += loop;
}

/* joint NAME KIND PARENT[.NODE]|ground CHILD, its lines, end */
static void scene_read_joint(text_file *t, scene *s)
{
  scene_read_any_joint(t, s, 0);
}

/* loop NAME KIND PARENT[.NODE]|ground CHILD[.NODE], its lines, end */
static void scene_read_loop(text_file *t, scene *s)
{
  scene_read_any_joint(t, s, 1);
}

static int scene_spring_of(text_file *t, const scene *s)
{
  const char *const word = text_word(t);
  for (int k = 0; k < s->n_spring && word; k++) {
    if (strcmp(s->spring[k].name, word) == 0) {
      return k;
    }
  }
  text_fail(t, "no spring has the name %s", word ? word : "(missing)");
  return 0;
}

static void scene_read_spring_line(text_file *t, scene *s, scene_spring *spring, const char *word)
{
  static const char *const words[] = {"stiffness", "length", "damping"};
  fb_spring *const d = &spring->desc;
  fb_real *const number[] = {&d->stiffness, &d->length, &d->damping};
  text_once(t, &spring->seen, word);
  text_note(t, &spring->seen, word);
  for (int k = 0; k < 3; k++) {
    if (strcmp(word, words[k]) == 0) {
      *number[k] = (fb_real)text_number(t, word);
      if (!t->failed && *number[k] < 0) {
        text_fail(t, "%s must not be negative", word);
      }
      text_end_of_line(t);
      return;
    }
  }
  if (strcmp(word, "position") == 0) {
    text_reals(t, word, d->position[0], 3);
    text_reals(t, word, d->position[1], 3);
  } else if (strcmp(word, "pull") == 0) {
    spring->pull = function_read(t, &s->tables, s->path);
    spring->pulls = 1;
  } else {
    text_fail(t, "no such word for a spring: %s", word);
    return;
  }
  text_end_of_line(t);
}

/* spring NAME NODE|ground NODE|ground, its lines, end */
static void scene_read_spring(text_file *t, scene *s)
{
  scene_spring *const spring = &s->spring[s->n_spring];
  if (s->n_spring == FB_MAX_SPRINGS) {
    text_fail(t, "more than %d springs", FB_MAX_SPRINGS);
    return;
  }
  memset(spring, 0, sizeof *spring);
  spring->line = t->line;
  spring->act = -1;
  text_name(t, "a spring", spring->name);
  for (int k = 0; k < s->n_spring; k++) {
    if (strcmp(s->spring[k].name, spring->name) == 0) {
      text_fail(t, "two springs have the name %s", spring->name);
    }
  }
  for (int side = 0; side < 2; side++) {
    if (text_take(t, "ground")) {
      spring->desc.body[side] = FB_GROUND;
    } else {
      scene_read_node(t, s, &spring->desc.body[side], &spring->desc.node[side]);
    }
  }
  if (!t->failed && spring->desc.body[0] == FB_GROUND && spring->desc.body[1] == FB_GROUND) {
    text_fail(t, "spring %s connects the ground to itself", spring->name);
  }
  text_end_of_line(t);
  text_begin(t, "spring", spring->name);
  while (text_within(t)) {
    scene_read_spring_line(t, s, spring, text_word(t));
  }
  s->n_spring++;
}

/* event T free|lock|prescribe JOINT AXIS */
static void scene_read_event(text_file *t, scene *s)
{
  static const char *const modes[] = {"free", "lock", "prescribe", NULL};
  scene_event *const event = &s->event[s->n_event];
  if (s->n_event == SCENE_EVENTS) {
    text_fail(t, "more than %d events", SCENE_EVENTS);
    return;
  }
  event->line = t->line;
  event->t = text_number(t, "time");
  event->mode = (fb_axis_mode)text_choice(t, "an event", modes);
  event->joint = scene_joint_of(t, s);
  event->axis = t->failed ? 0 : scene_read_axis(t, &s->joint[event->joint]);
  if (!t->failed && (event->t < 0 || (s->n_event > 0 && event->t < event[-1].t))) {
    text_fail(t, "events stand in the order of their times, none before 0");
  }
  s->n_event++;
}
#endif
