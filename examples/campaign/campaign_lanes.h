/* campaign_lanes.h - several runs of a campaign at once (--lanes): the equations of its scene as C of their own
   (../tools/code_tree.h), compiled when the campaign begins and loaded, one run to a lane of a vector.

   Runs differ in the numbers of the text and in nothing else: a few of them are written first, and the numbers in which
   these differ become places of a table, of which each lane has its own. A run whose text differs in more, or whose
   steps lie elsewhere, goes by the library, and so does one that is refused or fails, which tells why. Which way a run
   goes follows from the campaign and the run alone: rows are the same bits for any number of lanes. */
#ifndef CAMPAIGN_LANES_H
#define CAMPAIGN_LANES_H
#include "campaign_case.h"
#undef I /* that of complex.h: inertia below */
#include "../tools/code_tree.h"
#include <dlfcn.h>
#pragma weak dlopen
#pragma weak dlsym

enum { LANES_SAMPLES = 8, LANES_NUMBERS = 200000, LANES_BATCH = 64 };

typedef int lanes_steps(const void *model, void *state, const void *input, double dt, int n, int *done);

typedef struct lanes_output { /* c + gain.state, or the value of a prescribed axis */
  double c;
  int n, drive, axis; /* drive: joint whose axis it is, -1: none */
  struct {
    int at;
    double gain;
  } term[FB_MAX_MODES + 1];
} lanes_output;

typedef struct lanes_lane { /* one run */
  campaign_row row;
  int gone; /* by the library, or a copy of another lane: no row */
  int n_measure, n_drive;
  scene_measure measure[SCENE_MEASURES];
  scene_drive drive[SCENE_DRIVES];
  double measured[SCENE_MEASURES]; /* of the start */
  double origin[SCENE_JOINTS][3];
  lanes_output output[SCENE_OUTPUTS];
  scene_tally tally[SCENE_MEASURES];
} lanes_lane;

static struct lanes {
  int wide, n;   /* lanes; runs in hand */
  int model_run; /* that whose text is compiled */
  /* the form of the text, of the first run that is written: */
  char *text;
  size_t length;
  int n_number, n_place, n_state, n_input;
  double *number; /* of that run */
  int *slot;      /* place of each in the table, -1: the number is the same in all */
  int *first;     /* number that a place is of */
  size_t *offset; /* where it stands in memory, as lanes_noted has it */
  struct scene_clock clock;
  function_tables tables;
  /* at work */
  void *program;
  lanes_steps *steps;
  double *model, *state, *input, *alone[3]; /* by lanes; alone: model, state, input of one run in all lanes */
  lanes_lane lane[8];
} lanes;

static struct lanes_noted { /* the text of a run */
  char *text;
  size_t length;
  int n;
  double *number;
  size_t *offset; /* where it stands in memory, the bodies one behind the other, then the system */
  FILE *out;
} lanes_noted;

/* ---- what can go by lanes */

/* What of a scene cannot, with what would be right; NULL: nothing. */
static const char *lanes_scene_refusal(const scene *s)
{
  const struct {
    int n;
    const char *what;
  } other[] = {
      {!scene_is_system(s) || s->is_exact, "one body without a joint: choose bodies on joints"},
      {s->n_load, "a load or nudge does not go by lanes: let motors or prescribed axes act, or leave --lanes out"},
      {s->n_distributed, "distributed: choose a scene without"},
      {s->n_control, "control: choose springs and dampers of joints"},
      {s->n_spring, "spring: choose stiffness and damping of joints"},
      {s->n_event, "event: choose a scene without"},
      {s->n_rotor, "rotor: choose bodies without"},
      {!(s->step > 0), "no step is given: give it"},
      {engine.integrator != FB_INTEGRATOR_RK4, "another integrator than rk4"}};
  for (int k = 0; k < (int)(sizeof other / sizeof *other); k++) {
    if (other[k].n > 0) {
      return other[k].what;
    }
  }
  return NULL;
}

static int lanes_is_tallied(const scene *s, int output)
{
  int is = 0;
  for (int k = 0; k < s->n_measure; k++) {
    is |= s->measure[k].kind < SCENE_FREQUENCY && s->measure[k].output == output;
  }
  return is;
}

/* Outputs follow from places alone, and linearly: displacements of lines that bend far do not. */
static int lanes_is_place(const scene *s, const scene_output *o)
{
  const int linear = o->quantity == SCENE_DISPLACEMENT || o->quantity == SCENE_STRAIN;
  return o->quantity == SCENE_COORDINATE ? scene_axes(&s->joint[o->at]) < 3 && !s->joint[o->at].loop
         : linear                        ? !(engine.body[o->body].effects & FB_EFFECT_LARGE_DEFLECTION)
                                         : o->quantity == SCENE_MODE;
}

static const char *lanes_output_refusal(const scene *s)
{
  static char text[160];
  for (int k = 0; k < s->n_output; k++) {
    const scene_output *const o = &s->output[k];
    if (lanes_is_tallied(s, k) && !lanes_is_place(s, o)) {
      snprintf(
          text, sizeof text,
          "output %.40s: measure coordinates of axes, displacements, modes or strains, of effects large modes alone",
          o->label);
      return text;
    }
  }
  return NULL;
}

static const tree_choice lanes_choice = {"lanes", 0, TREE_LANES_ALONE, 0, NULL, {{{0}}}, {0}, NULL};

/* Of a loop nothing is told and nothing is part of a state. */
static const char *lanes_loop_refusal(const scene *s)
{
  static char text[120];
  for (int k = 0; k < s->n_joint; k++) {
    const scene_joint *const joint = &s->joint[k];
    int moved = 0;
    for (int i = 0; i < engine.system.joint[joint->at].n_axis && joint->loop; i++) {
      moved |= engine.system.joint[joint->at].mode[i] != FB_AXIS_FREE;
    }
    for (int i = 0; i < s->n_drive && joint->loop; i++) {
      moved |= s->drive[i].joint == k;
    }
    if (moved) {
      snprintf(text, sizeof text, "loop %.40s: choose mode free and no motor, or open another joint", joint->name);
      return text;
    }
  }
  return NULL;
}

/* The scene that has been built and started; text: what cannot go by lanes, "": nothing. */
static void lanes_refusal(char text[200], const scene *s)
{
  const char *what = lanes_scene_refusal(s);
  what = what ? what : lanes_output_refusal(s);
  what = what ? what : lanes_loop_refusal(s);
  snprintf(text, 200, "%s", what ? what : "");
}

/* ---- the text and its numbers */

static const char lanes_head[] = "#include <math.h>\n#include <string.h>\n#define @_LANES LANES\n\n";

static const char lanes_many_steps[] =
    "\n/* n steps of all lanes under what acts at the beginning, the middle and the end of each; done: before one that "
    "is refused,\n"
    "   which changes nothing. All begin where vectors do. */\n"
    "int @_steps(const void *model, void *state, const void *input, double dt, int n, int *done)\n{\n"
    "  @_status status = @_ok;\n"
    "  *done = 0;\n"
    "  while (*done < n && status == @_ok) {\n"
    "    const @_wide_input *const in = (const @_wide_input *)input + 2 * *done;\n"
    "    status = @_wide_step((const @_wide_model *)model, (@_wide_state *)state, in, in + 1, in + 2, dt);\n"
    "    *done += status == @_ok;\n"
    "  }\n"
    "  return status;\n}\n";

/* What is written of the scene that is started; choice, names: to be filled, for as long as that lasts. */
static code lanes_written(FILE *out, tree_choice *choice, const char *names[FB_MAX_BODIES], const scene *s)
{
  *choice = lanes_choice;
  for (int k = 0; k < s->n_body; k++) {
    names[k] = s->body[k].name;
  }
  return tree_begin(out, &engine.system, engine.body, names, choice);
}

/* State, what acts and the table of all lanes. */
static void lanes_write_types(const code *w)
{
  tree_write_types(w);
  fprintf(w->out, "typedef struct %s_wide_model {\n  %s_loose k[%d];\n} %s_wide_model;\n\n", w->name, code_real(w),
          w->places, w->name);
}

/* Writes the equations of the scene that is started, whose table has so many places; 0, and why. */
static int lanes_write(FILE *out, const scene *s, int places, char why[400])
{
  static tree_choice choice;
  static const char *names[FB_MAX_BODIES];
  const trace_table table = {lanes.n_number, lanes.n_place, lanes.offset, lanes.slot};
  code w = lanes_written(out, &choice, names, s);
  const trace_choice what = {.name = w.name,
                             .file = s->path,
                             .loads = choice.loads,
                             .body = names,
                             .pulls = choice.pulls,
                             .table = &table,
                             .wide = 1};
  const trace_model of = {engine.body,
                          &engine.system,
                          &engine.system_state,
                          sizeof engine.body[0],
                          sizeof engine.system,
                          sizeof engine.system_state,
                          s->n_body};
  w.places = places;
  code_template(&w, lanes_head);
  tree_write_status(&w);
  code_write_vectors(&w, lanes_write_types);
  if (trace_step(out, &what, &of, why) != 0) {
    return 0;
  }
  code_template(&w, lanes_many_steps);
  return 1;
}

/* A member of the models: a number and where it stands, or an integer as part of the form. */
static void lanes_meet(void *to, const int *integer, const fb_real *number, int n)
{
  struct lanes_noted *const noted = (struct lanes_noted *)to;
  const char *const at = (const char *)number, *const system = (const char *)&engine.system;
  for (int i = 0; i < n && integer; i++) {
    fprintf(noted->out, " %d", integer[i]);
  }
  for (int i = 0; i < n && number; i++, noted->n++) {
    if (noted->n < LANES_NUMBERS) {
      const size_t own = (size_t)i * sizeof *number;
      noted->number[noted->n] = (double)number[i];
      noted->offset[noted->n] = at >= system && at < system + sizeof engine.system
                                    ? (size_t)case_scene.n_body * sizeof *engine.body + (size_t)(at - system) + own
                                    : (size_t)(at - (const char *)engine.body) + own;
    }
  }
  fputs(number ? " #" : "", noted->out);
}

/* The numbers of the models and their form without them. */
static void lanes_note_models(struct lanes_noted *noted, const scene *s)
{
  static tree_choice choice;
  static const char *names[FB_MAX_BODIES];
  lanes_written(noted->out, &choice, names, s); /* the layout of a state */
  noted->n = 0;
  inside_walk(lanes_meet, noted, &engine.system, engine.body, s->n_body);
  for (int k = 0; k < s->n_body; k++) {
    for (int i = 0; i < 3; i++) {
      fprintf(noted->out, " %d", (int)engine.system_state.mode[k][i]);
    }
  }
}

/* Its numbers, and its text without them, to lanes_noted; 0: no memory, or too many. */
static int lanes_note(const scene *s)
{
  struct lanes_noted *const noted = &lanes_noted;
  FILE *out;
  free(noted->text);
  noted->text = NULL;
  noted->offset = noted->offset ? noted->offset : malloc(LANES_NUMBERS * sizeof *noted->offset);
  noted->number = noted->number ? noted->number : malloc(LANES_NUMBERS * sizeof *noted->number);
  out = noted->number ? open_memstream(&noted->text, &noted->length) : NULL;
  if (!out || !noted->offset) {
    return 0;
  }
  noted->out = out;
  lanes_note_models(noted, s);
  return fclose(out) == 0 && noted->n <= LANES_NUMBERS;
}

static int lanes_is_same_form(void)
{
  return lanes_noted.n == lanes.n_number && lanes_noted.length == lanes.length &&
         memcmp(lanes_noted.text, lanes.text, lanes.length) == 0;
}

/* Do the steps of this scene lie where those of the first lie, under the same tables? */
static int lanes_is_same_time(const scene *s)
{
  const struct scene_clock *const a = &timing, *const b = &lanes.clock;
  return a->rows == b->rows && a->interval == b->interval && a->longest == b->longest && a->n == b->n && /* NOLINT */
         memcmp(a->instant, b->instant, (size_t)a->n * sizeof *a->instant) == 0 && s->tables.n == lanes.tables.n &&
         memcmp(s->tables.row, lanes.tables.row, (size_t)s->tables.n * sizeof *s->tables.row) == 0;
}

/* The numbers of the noted text into a lane of a table of `wide` lanes; 0: one differs that is the same in all. */
static int lanes_fill(double *table, int lane, int wide)
{
  int good = 1;
  for (int k = 0; k < lanes.n_place; k++) {
    table[k * wide + lane] = lanes_noted.number[lanes.first[k]];
  }
  for (int i = 0; i < lanes.n_number; i++) {
    const double known = lanes.slot[i] < 0 ? lanes.number[i] : table[lanes.slot[i] * wide + lane];
    good &= memcmp(&known, &lanes_noted.number[i], sizeof known) == 0;
  }
  return good;
}

/* ---- a run before its first step */

/* Builds and starts the scene of a run as scene_run does. 0: it is for the library to tell why not. */
static int lanes_prepare(const campaign *c, int run)
{
  static const scene_options quiet = {0};
  scene *const s = &case_scene;
  scene_setting setting[2 * CAMPAIGN_VARY];
  const int n = case_settings(c, setting, run);
  clear_memory(&engine, offsetof(struct scene_engine, body));
  if (scene_read(s, c->scene, setting, n)) {
    return 0;
  }
  scene_reset(s);
  if (scene_build(s, &quiet) || scene_start(s) != FB_OK || automatic.doubted || scene_measure_spectrum(s)) {
    return 0;
  }
  scene_clock_init(s, scene_rows(s));
  scene_choose(s);
  return s->duration > 0 && !scene_check_steps(s, &quiet);
}

static int lanes_is_free(int k)
{
  return tree.link[k].joint->kind == FB_JOINT_FREE;
}

/* Where members of bodies are in the flat state (of a free body x, u and what they lost, without u where loops tie it to the
   ground; coordinates or quat, p, q with pi behind) and in what acts. */
static int lanes_state_place(int k, char member)
{
  int at = 0;
  for (int j = 0; j < k + (member != 'u'); j++) {
    const tree_link *const L = &tree.link[j];
    const int root = lanes_is_free(j), frame = !root ? 0 : tree.tied ? 6 : 12, p = root ? 6 : tree_momenta_of(L);
    const int x = root || tree_is_ball(L) ? 4 : L->axes;
    at += frame + (j < k || member != 'x' ? x : 0) + (j < k || member == 'q' ? p : 0) + (j < k ? 2 * L->n : 0);
  }
  return at;
}

static int lanes_input_place(int k)
{
  int at = 0;
  for (int j = 0; j < k; j++) {
    for (int m = 0; m < TREE_AT_NODES; m++) { /* of loads there are none */
      at += tree_input_size(j, m);
    }
  }
  return at;
}

static void lanes_take_state(double *state, int lane, int wide)
{
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    const fb_link_state *const from = &engine.system_state.link[k];
    const int root = lanes_is_free(k), ball = root || tree_is_ball(L);
    double *const x = state + lanes_state_place(k, 'x') * wide + lane;
    double *const p = state + lanes_state_place(k, 'p') * wide + lane;
    double *const q = state + lanes_state_place(k, 'q') * wide + lane;
    for (int i = 0; i < (ball ? 4 : L->axes); i++) {
      x[i * wide] = (double)(ball ? from->quat[i] : from->x[i]);
    }
    for (int i = 0; i < (root ? 6 : tree_momenta_of(L)); i++) {
      p[i * wide] = (double)from->p[i];
    }
    for (int i = 0; i < (tree.tied ? 6 : 12) && root; i++) {
      const fb_real *const frame[4] = {from->x, tree.tied ? from->lost_x : from->u, from->lost_x, from->lost_u};
      state[(lanes_state_place(k, 'u') + i) * wide + lane] = (double)frame[i / 3][i % 3];
    }
    for (int a = 0; a < L->n; a++) {
      q[a * wide] = (double)from->q[a];
      q[(L->n + a) * wide] = (double)from->pi[a];
    }
  }
  for (int i = lanes_state_place(tree.n, 'u'); i < lanes.n_state; i++) {
    state[i * wide + lane] = (double)engine.system_state.motor_work;
  }
}

static void lanes_add_term(lanes_output *out, int at, double gain)
{
  if (fabs(gain) > 0) {
    out->term[out->n].at = at;
    out->term[out->n++].gain = gain;
  }
}

/* An output by the state: linear in the coordinates of the modes, or a coordinate. */
static void lanes_output_init(lanes_output *out, const scene *s, const scene_output *o)
{
  memset(out, 0, sizeof *out);
  out->drive = -1;
  if (o->quantity == SCENE_COORDINATE) {
    const int at = s->joint[o->at].at;
    out->axis = o->axis;
    out->drive = tree.link[at].joint->mode[o->axis] != FB_AXIS_FREE ? o->at : -1;
    if (out->drive < 0) {
      lanes_add_term(out, lanes_state_place(at, 'x') + o->axis, 1);
    }
    return;
  }
  fb_state *const pose = &engine.view.motion.pose[o->body];
  memset(pose, 0, sizeof *pose);
  memset(&engine.view.motion.motion[o->body], 0, sizeof engine.view.motion.motion[o->body]);
  pose->quat[0] = 1;
  out->c = scene_value(s, o);
  for (int a = 0; a < engine.body[o->body].n; a++) {
    pose->q[a] = 1;
    lanes_add_term(out, lanes_state_place(o->body, 'q') + a, scene_value(s, o) - out->c);
    pose->q[a] = 0;
  }
}

/* What a lane keeps of the scene that is started. */
static void lanes_keep(lanes_lane *lane, const scene *s)
{
  lane->n_measure = s->n_measure;
  lane->n_drive = s->n_drive;
  memcpy(lane->measure, s->measure, sizeof lane->measure);
  memcpy(lane->drive, s->drive, sizeof lane->drive);
  memcpy(lane->origin, engine.origin, sizeof lane->origin);
  memcpy(lane->measured, s->measured, (size_t)s->n_measure * sizeof *s->measured);
  memset(lane->tally, 0, sizeof lane->tally);
  for (int k = 0; k < s->n_output; k++) {
    if (lanes_is_tallied(s, k)) {
      lanes_output_init(&lane->output[k], s, &s->output[k]);
    }
  }
}

/* ---- the way through time */

static int lanes_has_same_drives(const lanes_lane *a, const lanes_lane *b)
{
  return a->n_drive == b->n_drive && memcmp(a->drive, b->drive, (size_t)a->n_drive * sizeof *a->drive) == 0 &&
         memcmp(a->origin, b->origin, sizeof a->origin) == 0;
}

/* What drives the axes of joint j (of the scene) in a run. */
static fb_drive lanes_drive(const lanes_lane *lane, int j, double t, double side)
{
  fb_drive drive;
  memset(&drive, 0, sizeof drive);
  for (int i = 0; i < 3; i++) {
    drive.value[i] = (fb_real)lane->origin[j][i];
  }
  for (int k = 0; k < lane->n_drive; k++) {
    if (lane->drive[k].joint == j) {
      system_drive_add(&drive, &lane->drive[k], scene_axes(&case_scene.joint[j]), &lanes.tables, t, side);
    }
  }
  return drive;
}

/* What acts on a lane at t, into a column of what acts on all. */
static void lanes_act(double *input, int lane, double t, double side)
{
  const scene *const s = &case_scene;
  const int wide = lanes.wide;
  for (int j = 0; j < s->n_joint; j++) {
    if (s->joint[j].loop) {
      continue;
    }
    const tree_link *const L = &tree.link[s->joint[j].at];
    double *const to = input + lanes_input_place(s->joint[j].at) * wide + lane;
    const int motors = tree_momenta_of(L) * wide, values = tree_is_valued(L) ? L->axes * wide : 0;
    const fb_drive drive = lanes_drive(&lanes.lane[lane], j, t, side);
    for (int i = 0; i < L->axes; i++) {
      if (L->joint->mode[i] == FB_AXIS_FREE) {
        to[i * wide] = (double)drive.torque[i];
      } else if (L->joint->mode[i] == FB_AXIS_PRESCRIBED) {
        to[motors + values + i * wide] = (double)drive.rate[i];
      }
      if (L->joint->mode[i] == FB_AXIS_PRESCRIBED && values > 0) {
        to[motors + i * wide] = (double)drive.value[i];
      }
    }
  }
}

/* What acts on all lanes: those that are driven alike are evaluated once. */
static void lanes_act_all(double *input, double t, double side)
{
  const int wide = lanes.wide;
  lanes_act(input, 0, t, side);
  for (int k = 1; k < wide; k++) {
    if (lanes_has_same_drives(&lanes.lane[0], &lanes.lane[k])) {
      for (int i = 0; i < lanes.n_input; i++) {
        input[i * wide + k] = input[i * wide];
      }
    } else {
      lanes_act(input, k, t, side);
    }
  }
}

/* A lane takes a copy of what another one has: of its run there is no row here. */
static void lanes_drop(int lane, int other)
{
  const int wide = lanes.wide;
  for (int i = 0; i < lanes.n_state; i++) {
    lanes.state[i * wide + lane] = lanes.state[i * wide + other];
  }
  for (int i = 0; i < lanes.n_place; i++) {
    lanes.model[i * wide + lane] = lanes.model[i * wide + other];
  }
  lanes.lane[lane].n_drive = lanes.lane[other].n_drive;
  memcpy(lanes.lane[lane].drive, lanes.lane[other].drive, sizeof lanes.lane[lane].drive);
  memcpy(lanes.lane[lane].origin, lanes.lane[other].origin, sizeof lanes.lane[lane].origin);
  lanes.lane[lane].gone = 1;
}

/* One number to all lanes. */
static void lanes_spread(double *to, const double *from, int n, int lane)
{
  for (int i = 0; i < n * lanes.wide; i++) {
    to[i] = from[i / lanes.wide * lanes.wide + lane];
  }
}

/* A step that one lane at least is refused: each by itself in all lanes. 0: none is left. */
static int lanes_step_alone(const double *input, double dt)
{
  const int wide = lanes.wide;
  int good = -1, done;
  for (int k = 0; k < wide; k++) {
    lanes_spread(lanes.alone[0], lanes.model, lanes.n_place, k);
    lanes_spread(lanes.alone[1], lanes.state, lanes.n_state, k);
    lanes_spread(lanes.alone[2], input, 3 * lanes.n_input, k);
    if (lanes.lane[k].gone || lanes.steps(lanes.alone[0], lanes.alone[1], lanes.alone[2], dt, 1, &done) != 0) {
      lanes.lane[k].gone = 1;
      continue;
    }
    good = k;
    for (int i = 0; i < lanes.n_state; i++) {
      lanes.state[i * wide + k] = lanes.alone[1][i * wide];
    }
  }
  for (int k = 0; k < wide && good >= 0; k++) {
    if (lanes.lane[k].gone) {
      lanes_drop(k, good);
    }
  }
  return good >= 0;
}

/* n steps from t; 0: no lane is left. */
static int lanes_batch(double t, double dt, double first, int n)
{
  const size_t one = (size_t)(lanes.n_input * lanes.wide);
  for (int i = 0; i <= 2 * n; i++) {
    const double begin = t + (first + (double)(i < 2 * n ? i / 2 : n - 1)) * dt;
    const double at = i == 2 * n ? begin + dt : i % 2 ? begin + 0.5 * dt : begin;
    lanes_act_all(lanes.input + (size_t)i * one, at, begin + 0.5 * dt);
  }
  for (int at = 0, done; at < n; at += done + 1) {
    if (lanes.steps(lanes.model, lanes.state, lanes.input + 2 * (size_t)at * one, dt, n - at, &done) == 0) {
      break;
    }
    if (!lanes_step_alone(lanes.input + 2 * (size_t)(at + done) * one, dt)) {
      return 0;
    }
  }
  return 1;
}

static double lanes_value(const lanes_lane *lane, int k, int at, double t)
{
  const lanes_output *const out = &lane->output[at];
  double value = out->c;
  for (int i = 0; i < out->n; i++) {
    value += out->term[i].gain * lanes.state[out->term[i].at * lanes.wide + k];
  }
  return out->drive < 0 ? value : (double)lanes_drive(lane, out->drive, t, t + timing.slack).value[out->axis];
}

static void lanes_row(double t)
{
  for (int k = 0; k < lanes.n; k++) {
    lanes_lane *const lane = &lanes.lane[k];
    for (int m = 0; m < lane->n_measure && !lane->gone; m++) {
      const scene_measure *const measure = &lane->measure[m];
      if (measure->kind < SCENE_FREQUENCY && t >= measure->after * (1 - 1e-12)) {
        scene_tally_add(&lane->tally[m], measure->kind, lanes_value(lane, k, measure->output, t));
      }
    }
  }
}

/* From row to row, as scene_loop. */
static void lanes_loop(const scene *s)
{
  int left = 1;
  lanes_row(0);
  for (long row = 0; row < timing.rows && left; row++) {
    const double start = (double)row * timing.interval, last = (double)(row + 1) * timing.interval;
    for (double t = start; t < last && left;) {
      const scene_piece p = scene_piece_from(s, start, last, t);
      for (double k = 0; k < p.steps && left; k += LANES_BATCH) {
        left = lanes_batch(t, p.dt, k, (int)fmin(LANES_BATCH, p.steps - k));
      }
      t = p.end;
    }
    lanes_row(last);
  }
}

/* ---- the runs of a worker */

static void lanes_end(const campaign *c, lanes_lane *lane)
{
  campaign_row *const row = &lane->row;
  row->status = ROW_OK;
  for (int m = 0; m < lane->n_measure; m++) {
    row->measured[m] =
        lane->tally[m].n > 0 ? scene_tally_end(&lane->tally[m], lane->measure[m].kind) : lane->measured[m];
    lane->gone |= !isfinite(row->measured[m]);
  }
  if (lane->gone) {
    case_run(c, row, row->run);
    row->by_library = 1;
  }
}

/* At most as many runs as there are lanes, to their rows in lanes.lane. */
static void lanes_run(const campaign *c, const int *run, int n)
{
  int good = -1;
  lanes.n = n;
  for (int k = 0; k < n; k++) {
    lanes_lane *const lane = &lanes.lane[k];
    memset(&lane->row, 0, sizeof lane->row);
    lane->row.run = run[k];
    lane->gone = !lanes_prepare(c, run[k]) || !lanes_is_same_time(&case_scene) || !lanes_note(&case_scene) ||
                 !lanes_is_same_form() || !lanes_fill(lanes.model, k, lanes.wide);
    if (!lane->gone) {
      good = k;
      lane->row.inputs = case_inputs(c, case_digest(c), run[k]);
      snprintf(lane->row.message, sizeof lane->row.message, "%.*s", CAMPAIGN_MESSAGE - 1, case_scene.warning);
      lanes_take_state(lanes.state, k, lanes.wide);
      lanes_keep(lane, &case_scene);
    }
  }
  for (int k = 0; k < lanes.wide && good >= 0; k++) {
    if (k >= n || lanes.lane[k].gone) {
      lanes_drop(k, good);
    }
  }
  good = good == n - 1 || (good >= 0 && lanes_prepare(c, run[good])); /* the scene is one of those in hand */
  if (good) {
    lanes_loop(&case_scene);
  }
  for (int k = 0; k < n; k++) {
    lanes.lane[k].gone |= !good;
    lanes_end(c, &lanes.lane[k]);
  }
}

/* The runs of a chunk, of which there may be more than lanes. */
static void lanes_rows(const campaign *c, campaign_row row[CASE_CHUNK], const case_chunk *chunk)
{
  for (int at = 0; at < chunk->n; at += lanes.wide) {
    const int n = chunk->n - at < lanes.wide ? chunk->n - at : lanes.wide;
    lanes_run(c, chunk->run + at, n);
    for (int k = 0; k < n; k++) {
      row[at + k] = lanes.lane[k].row;
    }
  }
}

/* ---- the beginning */

/* Runs that are written first: of the random ones the first, of combinations some between the first and the last. */
static int lanes_sample(const campaign *c, int k)
{
  double combinations = 1;
  for (int i = 0; i < c->n_vary; i++) {
    combinations *= campaign_levels(&c->vary[i]) ? campaign_levels(&c->vary[i]) : 1;
  }
  combinations = fmin(combinations, CAMPAIGN_RUNS);
  return combinations > LANES_SAMPLES ? (int)floor(k * (combinations - 1) / (LANES_SAMPLES - 1)) : k;
}

/* Numbers that differ become places of the table, those that are the same in all runs share one. */
static int lanes_places(double *const sample[LANES_SAMPLES], int n)
{
  const int room = 4 * lanes.n_number + 1;
  int *const seen = calloc((size_t)room, sizeof *seen); /* 1 + place */
  lanes.slot = malloc((size_t)lanes.n_number * sizeof *lanes.slot);
  lanes.first = malloc((size_t)lanes.n_number * sizeof *lanes.first);
  if (!seen || !lanes.slot || !lanes.first) {
    free(seen);
    return 0;
  }
  lanes.n_place = 0;
  for (int i = 0; i < lanes.n_number; i++) {
    uint64_t digest = CAMPAIGN_DIGEST;
    int same = 1, at;
    for (int k = 0; k < n; k++) {
      char bytes[sizeof(double)];
      memcpy(bytes, &sample[k][i], sizeof bytes);
      digest = campaign_digest(digest, bytes, sizeof bytes);
      same &= memcmp(&sample[k][i], &sample[0][i], sizeof(double)) == 0;
    }
    lanes.slot[i] = -1;
    for (at = (int)(digest % (uint64_t)room); !same && seen[at]; at = (at + 1) % room) {
      int equal = 1;
      for (int k = 0; k < n; k++) {
        equal &= memcmp(&sample[k][i], &sample[k][lanes.first[seen[at] - 1]], sizeof(double)) == 0;
      }
      if (equal) {
        lanes.slot[i] = seen[at] - 1;
        break;
      }
    }
    if (!same && lanes.slot[i] < 0) {
      seen[at] = lanes.n_place + 1;
      lanes.first[lanes.n_place] = i;
      lanes.slot[i] = lanes.n_place++;
    }
  }
  free(seen);
  return 1;
}

/* The form of the first of these runs that can go by lanes, and the numbers in which the others of its form differ. 0 and
   why there is none. */
static int lanes_form(const campaign *c, char why[200])
{
  double *sample[LANES_SAMPLES];
  int n = 0;
  snprintf(why, 200, "none of its first runs starts");
  for (int k = 0; k < LANES_SAMPLES && (!c->latin || k < c->runs); k++) {
    if (!lanes_prepare(c, lanes_sample(c, k))) {
      continue;
    }
    lanes_refusal(why, &case_scene);
    if (why[0] && n == 0) {
      return 0;
    }
    if (why[0] || !lanes_note(&case_scene)) {
      continue;
    }
    if (n == 0) {
      lanes.model_run = lanes_sample(c, k);
      lanes.text = lanes_noted.text;
      lanes.length = lanes_noted.length;
      lanes.n_number = lanes_noted.n;
      lanes.n_state = lanes_state_place(tree.n, 'u') + tree.works;
      lanes.n_input = lanes_input_place(tree.n) > 0 ? lanes_input_place(tree.n) : 1; /* a struct is not empty */
      lanes.clock = timing;
      lanes.tables = case_scene.tables;
      lanes.offset = lanes_noted.offset;
      lanes_noted.text = NULL;
      lanes_noted.offset = NULL;
    } else if (!lanes_is_same_form()) {
      continue;
    }
    sample[n++] = lanes_noted.number;
    lanes_noted.number = NULL;
  }
  lanes.number = n > 0 ? sample[0] : NULL;
  if (n == 0 || !lanes_places(sample, n)) {
    return 0;
  }
  for (int k = 1; k < n; k++) {
    free(sample[k]);
  }
  return 1;
}

static double *lanes_room(int n)
{
  void *room = NULL; /* as vectors want it */
  return posix_memalign(&room, 64, (size_t)(n > 0 ? n : 1) * (size_t)lanes.wide * sizeof(double)) == 0
             ? memset(room, 0, (size_t)(n > 0 ? n : 1) * (size_t)lanes.wide * sizeof(double))
             : NULL;
}

/* What the compiler said first. */
static void lanes_tell(const char *folder, const char *compiler, char why[200])
{
  char path[CAMPAIGN_PATH], line[110] = "";
  FILE *log;
  snprintf(path, sizeof path, "%.380s/log", folder);
  log = fopen(path, "r");
  if (log) {
    line[fgets(line, sizeof line, log) ? strcspn(line, "\n") : 0] = 0;
    fclose(log);
  }
  snprintf(why, 200, "gcc or clang is wanted for its equations (CC=%.40s): %.100s", compiler, line);
}

/* Compiles folder/lanes.c; 0: the compiler is not there, or refuses it. */
static int lanes_compile(const char *folder, char why[200])
{
  const char *const given = getenv("CC"), *const compiler = given && given[0] ? given : "cc";
  static const char *const own[] = {"-march=native", ""};
  char command[4 * CAMPAIGN_PATH];
  for (int k = 0; k < 2; k++) {
    snprintf(command, sizeof command,
             "%.200s -std=c99 -O2 %s -ffp-contract=off -fPIC -shared -DLANES=%d -o '%.320s/lanes.so' '%.320s/lanes.c' "
             "-lm > '%.320s/log' 2>&1",
             compiler, own[k], lanes.wide, folder, folder, folder);
    if (system(command) == 0) {
      return 1;
    }
  }
  lanes_tell(folder, compiler, why);
  return 0;
}

/* Writes, compiles and loads the program; 0 and why not. */
static int lanes_load(const scene *s, char why[200])
{
  char folder[CAMPAIGN_PATH], path[CAMPAIGN_PATH + 16], text[400];
  const char *const temporary = getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp";
  static const char *const files[] = {"lanes.c", "lanes.so", "log"};
  FILE *out;
  int good;
  snprintf(folder, sizeof folder, "%.300s/flexbeam_lanes_XXXXXX", temporary);
  if (!mkdtemp(folder)) {
    snprintf(why, 200, "no folder in %.100s: %s", temporary, strerror(errno));
    return 0;
  }
  snprintf(path, sizeof path, "%s/lanes.c", folder);
  out = fopen(path, "w");
  snprintf(text, sizeof text, "cannot write %.100s", path);
  good = out && lanes_write(out, s, lanes.n_place > 0 ? lanes.n_place : 1, text);
  good = out && fclose(out) == 0 && good;
  snprintf(why, 200, "%.199s", text);
  good = good && lanes_compile(folder, why);
  if (good) {
    snprintf(path, sizeof path, "%s/lanes.so", folder);
    lanes.program = dlopen ? dlopen(path, RTLD_NOW | RTLD_LOCAL) : NULL; /* older systems: link with -ldl */
    good = lanes.program != NULL;
    snprintf(why, 200, "its equations cannot be loaded%s", dlopen ? "" : " by this program, which has no dlopen");
  }
  if (good) {
    void *const steps = dlsym(lanes.program, "lanes_steps");
    memcpy(&lanes.steps, &steps, sizeof steps);
    good = lanes.steps != NULL;
  }
  for (int k = 0; k < 3; k++) {
    snprintf(path, sizeof path, "%s/%s", folder, files[k]);
    remove(path);
  }
  rmdir(folder);
  return good;
}

/* For `wide` runs at once; 0 and why that is not possible. */
static int lanes_begin(const campaign *c, int wide, char why[200])
{
  if (sizeof(fb_real) != sizeof(double)) {
    snprintf(why, 200, "this program is of single precision");
    return 0;
  }
  lanes.wide = wide;
  if (!lanes_form(c, why) || !lanes_prepare(c, lanes.model_run) || !lanes_load(&case_scene, why)) {
    return 0;
  }
  lanes.model = lanes_room(lanes.n_place);
  lanes.state = lanes_room(lanes.n_state);
  lanes.input = lanes_room((2 * LANES_BATCH + 1) * lanes.n_input);
  lanes.alone[0] = lanes_room(lanes.n_place);
  lanes.alone[1] = lanes_room(lanes.n_state);
  lanes.alone[2] = lanes_room(3 * lanes.n_input);
  snprintf(why, 200, "no memory");
  return lanes.model && lanes.state && lanes.input && lanes.alone[0] && lanes.alone[1] && lanes.alone[2];
}
#endif
