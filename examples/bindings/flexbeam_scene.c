/* flexbeam_scene.c - flexbeam_scene.h, as a third interface around what FMUs of scenes are made of: examples/fmu/fmu_core.h
   (values by reference, steps, saved states) and fmu_scene.h (the scene that runs). */
#define FMU_INTERFACE 3
#define FMU_STATIC 0
#include "../fmu/fmu_scene.h"
#include "../scene/scene_track.h"

typedef struct fmu_host {
  int none;
} fmu_host;

#include "../fmu/fmu_core.h"
#include "../fmu/fmu_instance.h"
#ifdef __GNUC__
#define FBS_API __attribute__((visibility("default")))
#endif
#include "../common/advice_out.h"
#include "flexbeam_scene.h"

struct fbs {
  fmu f;
  text_fault fault;
  char *text, *advice, *fields;
  fmu_saved *saved;
  struct scene_plant *linear; /* NULL: nobody asked for it */
  scene_mode *mode;
  int n_mode;
  track *curves; /* NULL: nobody asked for them */
  int n_input,
      n_output; /* of the scene as it was opened: what a refused parameter leaves of it in f.plant has others */
  double duration, interval;
  int changed; /* are those perhaps of other parameters? */
};

int fbs_interface(void)
{
  return 1;
}

const char *fbs_version(void)
{
  return FB_VERSION;
}

/* ---- errors */

static void fbs_blame(fbs *s, const char *word)
{
  text_blame(&s->fault, "", 0, word);
}

/* The first word of the line that is at fault, where no word is known. */
static void fbs_find_word(fbs *s)
{
  text_file t;
  char message[TEXT_MESSAGE];
  const char *word = NULL;
  const int is_scene = strcmp(s->fault.file, s->f.plant.path) == 0;
  if (!text_try_of(&t, "", s->fault.file, is_scene ? s->f.plant.text : NULL)) {
    return;
  }
  t.message = message;
  while (t.line < s->fault.line && text_raw_line(&t)) {
  }
  t.buffer[strcspn(t.buffer, "\r\n#")] = 0;
  word = text_word(&t);
  snprintf(s->fault.word, sizeof s->fault.word, "%s", word ? word : "");
  text_close(&t);
}

/* What the complaint of the scene is about; others are about a word that was passed. */
static int fbs_told(fbs *s, fmu_answer answer)
{
  const scene *const of = &s->f.plant.s;
  if (answer != FMU_OK && of->message[0] && strncmp(s->f.text, of->message, 700) == 0) {
    s->fault = of->fault;
    if (!s->fault.word[0] && s->fault.line > 0) {
      fbs_find_word(s);
    }
  }
  return (int)answer;
}

/* One that names a word. */
static int fbs_refuse(fbs *s, const char *word, const char *why)
{
  fbs_blame(s, word);
  return (int)fmu_refuse(&s->f, FMU_ERROR, "%.200s%s%s", word, word[0] ? ": " : "", why);
}

const char *fbs_error(const fbs *s)
{
  return s->f.text;
}

const char *fbs_error_file(const fbs *s)
{
  return s->fault.file;
}

int fbs_error_line(const fbs *s)
{
  return s->fault.line;
}

const char *fbs_error_word(const fbs *s)
{
  return s->fault.word;
}

/* ---- instances */

fbs *fbs_new(void)
{
  fbs *const s = (fbs *)calloc(1, sizeof *s);
  if (s) {
    s->f.calls.take = calloc;
    s->f.calls.give = free;
  }
  return s;
}

static void fbs_give_curves(fbs *s)
{
  if (s->curves) {
    track_free(s->curves);
  }
  free(s->curves);
  s->curves = NULL;
}

static void fbs_give(fbs *s)
{
  free(s->linear);
  free(s->mode);
  fbs_give_curves(s);
  free(s->text);
  free(s->advice);
  free(s->fields);
  free(s->saved);
}

void fbs_free(fbs *s)
{
  if (s) {
    fbs_give(s);
    free(s);
  }
}

static void *fbs_copied(const void *from, size_t bytes)
{
  void *const to = calloc(1, bytes + 1);
  if (to) {
    copy_memory(to, from, bytes);
  }
  return to;
}

/* Duration and interval of the scene that was read last. */
static void fbs_note(fbs *s)
{
  const scene *const of = &s->f.plant.s;
  const long rows = scene_rows(of);
  s->duration = of->duration;
  s->interval = rows > 0 ? of->duration / (double)rows : 0;
  s->changed = 0;
}

/* Those of the present parameters, or where these are refused of the last ones that were not. */
static void fbs_look(fbs *s)
{
  const fmu_values all = fmu_all(&s->f);
  fmu_text text;
  if (s->changed && s->f.n_value > 0 && fmu_plant_prepare(&s->f.plant, &all, text) == FMU_OK) {
    fbs_note(s);
  }
}

/* Its token is the check word of the text, as of a file of it. */
static fmu_answer fbs_read(fbs *s, int n, const double *value)
{
  fmu_plant *const p = &s->f.plant;
  unsigned word = ~0u;
  fmu_answer answer;
  p->n_parameter = n;
  fmu_scene_wait();
  answer = fmu_scene_read(p, p->path, value, 0, s->f.text);
  fmu_scene_done();
  if (answer != FMU_OK) {
    return answer;
  }
  if (s->text) {
    const size_t all = strlen(s->text);
    for (size_t k = 0; k < all; k += sizeof word) {
      unsigned part = 0;
      memcpy(&part, s->text + k, all - k < sizeof part ? all - k : sizeof part);
      word = fbi_crc_word(word, part);
    }
  } else {
    (void)fmu_scene_word(&word, p->path);
  }
  fmu_scene_token(p, 0, word);
  fmu_scene_opened(p);
  fmu_list(&s->f);
  s->n_input = p->n_input;
  s->n_output = p->s.n_output;
  fbs_note(s);
  return FMU_OK;
}

int fbs_open(fbs *s, const char *name, const char *text, int n, const char *const *parameter, const double *value)
{
  fmu_plant *const p = &s->f.plant;
  if (p->is_alone) { /* opened before */
    fbs_give(s);
    fmu_clear(&s->f);
    memset((char *)s + sizeof s->f, 0, sizeof *s - sizeof s->f);
  }
  s->f.calls.take = calloc;
  s->f.calls.give = free;
  p->is_alone = 1;
  if (!name || n < 0 || (n > 0 && (!parameter || !value))) {
    return fbs_refuse(s, "", "a name, or a list of parameters is missing");
  }
  if (strlen(name) >= sizeof p->s.path || n > SCENE_PARAMETERS) {
    return fbs_refuse(s, name, n > SCENE_PARAMETERS ? "more parameters than a scene has" : "the name is too long");
  }
  strcpy(p->path, name);
  p->text = s->text = text ? (char *)fbs_copied(text, strlen(text) + 1) : NULL;
  if (text && !s->text) {
    return fbs_refuse(s, name, "there is no memory for the text");
  }
  for (int k = 0; k < n; k++) {
    if (!parameter[k] || strlen(parameter[k]) >= TEXT_NAME || !isfinite(value[k])) {
      return fbs_refuse(s, parameter[k] ? parameter[k] : "", "no name of a parameter, or no finite number");
    }
    strcpy(p->parameter[k], parameter[k]);
  }
  return fbs_told(s, fbs_read(s, n, value));
}

/* ---- lists */

/* Value reference of the first of a list that can be set or read. */
static int fbs_first(const fbs *s, int list)
{
  const int inputs = s->n_input, outputs = s->n_output;
  return list == FBS_INPUTS ? 1 : list == FBS_OUTPUTS ? 1 + inputs : 1 + inputs + outputs;
}

/* A list of the linear model, where that was asked for; *n: how many. */
static const linear_value *fbs_linear_list(const fbs *s, int list, int *n)
{
  const linear_out *const of = s->linear ? &s->linear->file : NULL;
  *n = !of                         ? 0
       : list == FBS_STATES        ? of->n
       : list == FBS_LINEAR_INPUTS ? of->n_in
       : list == FBS_POINT         ? of->n_point
                                   : of->n_out;
  return !of                         ? NULL
         : list == FBS_STATES        ? of->state
         : list == FBS_LINEAR_INPUTS ? of->in
         : list == FBS_POINT         ? of->point
                                     : of->out;
}

int fbs_count(const fbs *s, int list)
{
  const int inputs = s->n_input, outputs = s->n_output;
  int n = list == FBS_INPUTS ? inputs : list == FBS_OUTPUTS ? outputs : 0;
  if (list < 0 || list >= FBS_LISTS) {
    return -1;
  }
  if (list == FBS_PARAMETERS && s->f.n_value > 0) {
    n = s->f.n_value - 1 - inputs - outputs;
  } else if (list >= FBS_STATES && list < FBS_MODES) {
    (void)fbs_linear_list(s, list, &n);
  } else if (list >= FBS_MODES) {
    n = list < FBS_CURVES ? s->n_mode : s->curves ? s->curves->n_curve : 0;
  }
  return n;
}

/* Is there a number k of the list? */
static int fbs_has(fbs *s, int list, int k)
{
  if (k < 0 || k >= fbs_count(s, list)) {
    char number[16];
    snprintf(number, sizeof number, "%d", k);
    fbs_refuse(s, number, "there is no such index in the list, or no such list");
    return 0;
  }
  return 1;
}

/* Without "output." and "parameter.", which tell them from inputs in an FMU. */
static const char *fbs_plain(const char *name)
{
  static const char *const head[] = {"output.", "parameter."};
  for (int k = 0; k < 2; k++) {
    if (strncmp(name, head[k], strlen(head[k])) == 0) {
      return name + strlen(head[k]);
    }
  }
  return name;
}

/* Its name, or its unit. */
static const char *fbs_label(fbs *s, int list, int k, int is_unit)
{
  const linear_value *of;
  int n;
  if (!fbs_has(s, list, k)) {
    return NULL;
  }
  if (list < FBS_STATES) {
    const fmu_variable *const v = &s->f.variable[fbs_first(s, list) + k];
    return is_unit ? v->unit : fbs_plain(v->name);
  }
  if (list >= FBS_MODES) {
    return is_unit                  ? "rad/s"
           : list == FBS_MODES      ? s->mode[k].what
           : list == FBS_MODE_NAMES ? s->mode[k].name
                                    : s->curves->curve[k].name;
  }
  of = fbs_linear_list(s, list, &n);
  return is_unit ? of[k].unit : of[k].name;
}

const char *fbs_name(fbs *s, int list, int k)
{
  return fbs_label(s, list, k, 0);
}

const char *fbs_unit(fbs *s, int list, int k)
{
  const char *const unit = fbs_label(s, list, k, 1);
  return unit && !unit[0] ? "-" : unit;
}

int fbs_find(fbs *s, int list, const char *name)
{
  const int n = fbs_count(s, list);
  for (int k = 0; k < n && name; k++) {
    const char *const of = fbs_name(s, list, k);
    if (of && strcmp(of, name) == 0) {
      return k;
    }
  }
  fbs_refuse(s, name ? name : "", n < 0 ? "no such list" : "no number of the list has this name");
  return -1;
}

/* The value reference of element k of what is asked for; -1 after a refusal. */
static int fbs_reference(fbs *s, int list, const int *index, int k)
{
  const int at = index ? index[k] : k;
  if (list >= FBS_STATES) {
    fbs_refuse(s, "", "parameters, inputs and outputs are set and read");
    return -1;
  }
  return fbs_has(s, list, at) ? fbs_first(s, list) + at : -1;
}

/* Are there numbers? */
static int fbs_lacks(fbs *s, int n, const double *value)
{
  return n > 0 && !value ? fbs_refuse(s, "", "a list of numbers is missing") : FBS_OK;
}

int fbs_set(fbs *s, int list, int n, const int *index, const double *value)
{
  const int lacks = fbs_lacks(s, n, value);
  for (int pass = 0; pass < 2 && !lacks; pass++) { /* all of them or none */
    for (int k = 0; k < n; k++) {
      const int at = fbs_reference(s, list, index, k);
      const unsigned reference = (unsigned)at;
      fmu_answer answer = FMU_ERROR;
      if (at < 0) {
        return FBS_ERROR;
      }
      fbs_blame(s, fbs_name(s, list, index ? index[k] : k));
      answer = pass == 0 ? fmu_accepts(&s->f, &s->f.variable[at], 0, value[k])
                         : fmu_set(&s->f, &reference, 1, &value[k], 1, FMU_NUMBERS);
      s->changed |= list == FBS_PARAMETERS;
      if (answer != FMU_OK) {
        return (int)answer;
      }
    }
  }
  return lacks;
}

int fbs_get(fbs *s, int list, int n, const int *index, double *value)
{
  fmu_answer answer = FMU_OK;
  fbs_blame(s, "");
  if (fbs_lacks(s, n, value)) {
    return FBS_ERROR;
  }
  for (int k = 0; k < n && answer == FMU_OK; k++) {
    const int at = fbs_reference(s, list, index, k);
    if (at < 0) {
      return FBS_ERROR;
    }
    answer = list == FBS_OUTPUTS ? fmu_refresh(&s->f) : FMU_OK;
    value[k] = s->f.value[at];
  }
  return fbs_told(s, answer);
}

/* ---- steps */

double fbs_time(const fbs *s)
{
  return s->f.now.time;
}

double fbs_duration(fbs *s)
{
  fbs_look(s);
  return s->duration;
}

double fbs_interval(fbs *s)
{
  fbs_look(s);
  return s->interval;
}

/* May it be stepped? The first step ends what parameters may be set. */
static fmu_answer fbs_ready(fbs *s)
{
  fmu_answer answer = FMU_OK;
  fbs_blame(s, "");
  if (s->f.n_value == 0) {
    return fmu_refuse(&s->f, FMU_ERROR, "no scene is open");
  }
  answer = fmu_prepare(&s->f);
  if (answer != FMU_OK) {
    return answer;
  }
  fbs_note(s);
  if (!(s->duration > 0)) {
    return fmu_refuse(&s->f, FMU_ERROR, "a scene without duration computes its start alone");
  }
  if (s->f.now.mode == FMU_MADE) {
    answer = fmu_started(&s->f);
    answer = answer ? answer : fmu_begin(&s->f, 0, 0, 0);
    answer = answer ? answer : fmu_enter(&s->f);
    answer = answer ? answer : fmu_exit(&s->f);
  }
  return answer;
}

static fmu_answer fbs_advance(fbs *s, double time)
{
  const double from = fbs_time(s);
  const fmu_answer answer = time > from || time < from || !isfinite(time) ? fmu_step(&s->f, from, time - from) : FMU_OK;
  if (answer == FMU_OK) {
    s->f.value[0] = s->f.now.time = time;
  }
  return answer;
}

int fbs_step_to(fbs *s, double time)
{
  const fmu_answer answer = fbs_ready(s);
  return fbs_told(s, answer ? answer : fbs_advance(s, time));
}

int fbs_run(fbs *s, int n, double *rows, int *made)
{
  const int outputs = fbs_count(s, FBS_OUTPUTS);
  fmu_answer answer = made && (rows || n <= 0) ? fbs_ready(s) : FMU_ERROR;
  const double row = s->interval;
  if (!made || (!rows && n > 0)) {
    return fbs_refuse(s, "", "a place for rows is missing");
  }
  *made = 0;
  for (int k = 0; k < n && answer == FMU_OK; k++) {
    double *const to = rows + (size_t)k * (size_t)(1 + outputs);
    answer = fbs_advance(s, (floor(fbs_time(s) / row + 1e-6) + 1) * row);
    answer = answer ? answer : fmu_refresh(&s->f);
    to[0] = fbs_time(s);
    memcpy(to + 1, s->f.value + fbs_first(s, FBS_OUTPUTS), (size_t)outputs * sizeof *to);
    *made += answer == FMU_OK;
  }
  return fbs_told(s, answer);
}

int fbs_reset(fbs *s)
{
  fmu_reset(&s->f);
  s->changed = 1;
  return FBS_OK;
}

/* ---- saved states */

int fbs_save(fbs *s, void *bytes, size_t room, size_t *size)
{
  const fmu_answer answer =
      s->f.n_value > 0 ? fmu_keep(&s->f, &s->saved) : fmu_refuse(&s->f, FMU_ERROR, "no scene is open");
  fbs_blame(s, "");
  if (answer != FMU_OK) {
    return fbs_told(s, answer);
  }
  if (!size) {
    return fbs_refuse(s, "", "a place for the size is missing");
  }
  *size = s->saved->size;
  if (bytes && room < *size) {
    return fbs_refuse(s, "", "there is no room for the saved state");
  }
  if (bytes) {
    memcpy(bytes, s->saved, *size);
  }
  return FBS_OK;
}

int fbs_restore(fbs *s, const void *bytes, size_t size)
{
  fmu_answer answer = fmu_keep_bytes(&s->f, &s->saved, bytes, size);
  fbs_blame(s, "");
  answer = answer ? answer : fmu_load(&s->f, s->saved);
  s->changed = 1;
  return fbs_told(s, answer);
}

/* ---- about the start */

/* Builds the scene for the present parameters and inputs of 0. What runs is then no more the state: the next step begins
   with that. */
static fmu_answer fbs_build(fbs *s)
{
  fmu_plant *const p = &s->f.plant;
  double value[FMU_MAX_VALUES];
  const fmu_values all = {s->f.variable, s->f.n_value, value};
  fbs_blame(s, "");
  if (s->f.n_value == 0) {
    return fmu_refuse(&s->f, FMU_ERROR, "no scene is open");
  }
  memcpy(value, s->f.value, (size_t)s->f.n_value * sizeof *value);
  memset(value + 1, 0, (size_t)p->n_input * sizeof *value);
  p->begun = 0;
  return fmu_plant_prepare(p, &all, s->f.text);
}

/* The start of the scene that was built; the lock is this thread's. */
static fmu_answer fbs_start(fbs *s)
{
  scene *const of = &s->f.plant.s;
  const fb_status status = scene_start(of);
  if (status != FB_OK) {
    scene_no_start(of, status);
    return fmu_scene_said(s->f.text, FMU_ERROR, of->message);
  }
  return FMU_OK;
}

/* Takes it out of memory that all instances share. */
static fmu_answer fbs_keep_linear(fbs *s)
{
  const int failed = scene_linearize(&s->f.plant.s);
  free(s->linear);
  s->linear = failed ? NULL : (struct scene_plant *)fbs_copied(&plant, sizeof plant);
  return failed       ? fmu_scene_said(s->f.text, FMU_ERROR, s->f.plant.s.message)
         : !s->linear ? fmu_refuse(&s->f, FMU_ERROR, "there is no memory")
                      : FMU_OK;
}

static fmu_answer fbs_keep_modes(fbs *s)
{
  static scene_mode mode[SCENE_MODES]; /* under the lock */
  const int n = scene_modes(&s->f.plant.s, mode);
  free(s->mode);
  s->mode = n < 0 ? NULL : (scene_mode *)fbs_copied(mode, (size_t)n * sizeof *mode);
  s->n_mode = s->mode ? n : 0;
  return n < 0      ? fmu_scene_said(s->f.text, FMU_ERROR, s->f.plant.s.message)
         : !s->mode ? fmu_refuse(&s->f, FMU_ERROR, "there is no memory")
                    : FMU_OK;
}

static int fbs_analyse(fbs *s, fmu_answer (*keep)(fbs *s))
{
  fmu_answer answer = fbs_build(s);
  if (answer == FMU_OK) {
    fmu_scene_wait();
    answer = fbs_start(s);
    answer = answer ? answer : keep(s);
    fmu_scene_done();
  }
  return fbs_told(s, answer);
}

int fbs_linear(fbs *s)
{
  return fbs_analyse(s, fbs_keep_linear);
}

int fbs_modes(fbs *s)
{
  return fbs_analyse(s, fbs_keep_modes);
}

typedef struct fbs_family { /* of an instance over a parameter */
  fbs *s;
  int at; /* its value */
  fmu_answer answer;
} fbs_family;

/* The modes of one of them. */
static int fbs_family_at(void *user, double value, int named, track_row *row)
{
  fbs_family *const of = (fbs_family *)user;
  fbs *const s = of->s;
  int failed;
  s->f.value[of->at] = value;
  of->answer = fbs_build(s);
  if (of->answer != FMU_OK) {
    return 1;
  }
  fmu_scene_wait();
  of->answer = fbs_start(s);
  failed = of->answer != FMU_OK || track_take(row, &s->f.plant.s, value, named);
  fmu_scene_done();
  if (failed && of->answer == FMU_OK) {
    of->answer = fmu_scene_said(s->f.text, FMU_ERROR, s->f.plant.s.message);
  }
  return failed;
}

int fbs_campbell(fbs *s, const char *parameter, double from, double to, int n)
{
  const int k = fbs_find(s, FBS_PARAMETERS, parameter);
  fbs_family of = {s, fbs_first(s, FBS_PARAMETERS) + k, FMU_OK};
  double was;
  int failed;
  if (k < 0) {
    return FBS_ERROR;
  }
  if (n < 1 || n > 100000 || !isfinite(from) || !isfinite(to)) {
    return fbs_refuse(s, parameter, "modes are at one value or more, between finite ones");
  }
  fbs_give_curves(s);
  s->curves = (track *)calloc(1, sizeof *s->curves);
  if (!s->curves) {
    return fbs_refuse(s, "", "there is no memory");
  }
  was = s->f.value[of.at];
  failed = track_all(s->curves, fbs_family_at, &of, from, to, n);
  s->f.value[of.at] = was;
  if (failed) {
    fbs_give_curves(s);
    return failed == 2 ? fbs_refuse(s, "", "there is no memory") : fbs_told(s, of.answer);
  }
  return FBS_OK;
}

/* Rows of the table of curves, or how many numbers it has. */
static size_t fbs_table(const fbs *s, double *to)
{
  const track *const t = s->curves;
  const size_t width = t ? 2 + 2 * (size_t)t->n_curve : 0;
  for (int k = 0; t && to && k < t->made; k++) {
    double *const row = to + (size_t)k * width;
    row[0] = t->value[k];
    row[1] = t->spin[k];
    for (int a = 0; a < t->n_curve; a++) {
      row[2 + 2 * a] = t->curve[a].damped[k];
      row[3 + 2 * a] = t->curve[a].growth[k];
    }
  }
  return t ? (size_t)t->made * width : 0;
}

int fbs_matrix(fbs *s, int matrix, double *to, size_t n)
{
  const struct scene_plant *const of = s->linear;
  const int is_linear = matrix >= FBS_A && matrix <= FBS_D, is_point = matrix == FBS_POINT_VALUES;
  const size_t x = (size_t)fbs_count(s, FBS_STATES), u = (size_t)fbs_count(s, FBS_LINEAR_INPUTS),
               y = (size_t)fbs_count(s, FBS_LINEAR_OUTPUTS);
  const size_t size[] = {
      x * x, x * u, y * x, y * u, (size_t)fbs_count(s, FBS_POINT), 4 * (size_t)s->n_mode, fbs_table(s, NULL)};
  if (matrix < 0 || matrix >= FBS_MATRICES || n != size[matrix] || (n > 0 && !to) || (!of && (is_linear || is_point))) {
    return fbs_refuse(s, "", "no such matrix is there, or it has another number of elements");
  }
  if (is_linear) {
    const double *const from[] = {of->linear.A, of->B, of->C, of->D};
    memcpy(to, from[matrix], n * sizeof *to);
  }
  for (size_t k = 0; k < n && is_point; k++) {
    to[k] = of->file.point[k].value;
  }
  if (matrix == FBS_CURVE_VALUES) {
    (void)fbs_table(s, to);
  }
  for (int k = 0; k < s->n_mode && matrix == FBS_MODE_VALUES; k++) {
    const double value[] = {s->mode[k].undamped, s->mode[k].damped, s->mode[k].ratio, s->mode[k].growth};
    memcpy(to + 4 * k, value, sizeof value);
  }
  return FBS_OK;
}

/* What was written to a file, as a text of its own; NULL: that failed. */
static char *fbs_written(FILE *file)
{
  const long n = ftell(file);
  char *const text = n >= 0 ? (char *)calloc((size_t)n + 1, 1) : NULL;
  rewind(file);
  if (text && fread(text, 1, (size_t)n, file) != (size_t)n) {
    free(text);
    return NULL;
  }
  return text;
}

/* What a scene that has started chose, as JSON. */
static void fbs_put_fields(FILE *file, const fmu_plant *p)
{
  const char *comma = "";
  fprintf(file, "{\n  \"format\": \"flexbeam advice of a scene 1\",\n  \"flexbeam\": \"%s\",\n", FB_VERSION);
  advice_put_units(file);
  if (p->s.duration > 0) {
    fprintf(file, "  \"integrator\": \"%s\",\n  ", p->s.is_exact ? "exact" : scene_integrators[p->moving.integrator]);
    advice_put(file, "step", p->clock.taken);
    fputs(",\n  ", file);
    advice_put(file, "steps", p->clock.steps);
    fprintf(file, ",\n  \"chosen\": %s,\n", p->s.step > 0 ? "false" : "true");
  }
  fputs("  \"warning\": ", file);
  linear_quote(file, p->s.warning, 1);
  fputs(",\n  \"bodies\": {", file);
  for (int k = 0; k < p->s.n_body; k++) {
    if (p->s.body[k].tolerance > 0) { /* it asks for advice */
      fprintf(file, "%s\n    ", comma);
      linear_quote(file, p->s.body[k].name, 1);
      fputs(": {", file);
      advice_put_json(file, &p->advice[k], p->s.body[k].shape.n, p->s.body[k].tolerance);
      fputs("}", file);
      comma = ",";
    }
  }
  fputs("}\n}\n", file);
}

const char *fbs_advice(fbs *s)
{
  fmu_plant *const p = &s->f.plant;
  FILE *const talk = tmpfile(), *const fields = tmpfile();
  fmu_answer answer = FMU_ERROR;
  free(s->advice);
  free(s->fields);
  s->advice = s->fields = NULL;
  if (!talk || !fields) {
    fbs_refuse(s, "", strerror(errno));
    return NULL;
  }
  p->made = 0; /* building is what tells */
  p->options.talk = p->options.warn = talk;
  answer = fbs_build(s);
  answer = answer ? answer : fmu_scene_begin(p, s->f.text);
  p->options.talk = p->options.warn = NULL;
  p->begun = 0;
  if (answer == FMU_OK && p->s.step > 0) {
    fprintf(talk, "%s%s%ssteps of at most %.6g s, as the scene says\n", p->s.is_exact ? "" : "integrator ",
            p->s.is_exact ? "" : scene_integrators[p->moving.integrator], p->s.is_exact ? "" : ", ", p->s.step);
  }
  if (answer == FMU_OK) {
    fbs_put_fields(fields, p);
    s->fields = fbs_written(fields);
    s->advice = fbs_written(talk);
  }
  fclose(fields);
  fclose(talk);
  (void)fbs_told(s, answer);
  return s->advice;
}

const char *fbs_advice_json(const fbs *s)
{
  return s->fields;
}
