/* The generated step (code.h by reduce or scene --code) under hostile numbers and flipped bits, as hostile.c and faults.c
   attack the library. Each number of the state, of what acts, the step and, with VARY, of the model becomes none, infinite,
   huge, the largest, subnormal or another sign; each bit of state and model (all of small ones, a repeatable sample of
   large ones) flips before and during a run. Then, of the step and of what reads off the state:
     a status, one of those that the text names, and what was to be changed is as before,
     or 0, and all that was written is finite.
   With lanes that word is in one lane: each lane has the status and the bits of its single step.
   TREE: a tree, without rates; LOOPS: with loops; SDIRK: its L-stable one. NUMBER: double or float. PRESCRIBED: base, without energy. */
#define generated_IMPLEMENTATION
#include "code.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* All that a step reads. Structs of numbers alone. */
typedef struct subject {
  generated_state state;
  generated_input input[3];
  NUMBER dt;
#ifdef VARY
  generated_model model;
#endif
} subject;

#ifndef SAMPLE /* bits that flip */
#define SAMPLE 3000
#endif
enum { WORDS = sizeof(subject) / sizeof(NUMBER), BITS = 8 * sizeof(NUMBER), RUN = 12 };

static subject calm;
static int n_step, n_refused, n_wrong;

static int is_sound(const void *numbers, size_t size)
{
  for (size_t i = 0; i < size / sizeof(NUMBER); i++) {
    NUMBER x;
    memcpy(&x, (const char *)numbers + i * sizeof x, sizeof x);
    if (!isfinite(x)) {
      return 0;
    }
  }
  return 1;
}

static int is_status(int status)
{
#ifdef SDIRK
  if (status == generated_convergence) {
    return 1;
  }
#endif
  return status == generated_ok || status == generated_null || status == generated_value ||
         status == generated_not_finite || status == generated_step_length || status == generated_range ||
         status == -5 || status == -12 /* generated_singular, generated_contradiction, where there are */;
}

static void wrong(const char *what, int word, const char *how)
{
  if (n_wrong++ < 40) {
    printf("WRONG word %d of %d, %s: %s\n", word, (int)WORDS, how, what);
  }
}

static generated_status step(subject *s)
{
#ifdef VARY
  return generated_step(&s->model, &s->state, &s->input[0], &s->input[1], &s->input[2], s->dt);
#elif defined SDIRK
  return generated_step(&s->state, &s->input[0], &s->input[2], s->dt);
#else
  return generated_step(&s->state, &s->input[0], &s->input[1], &s->input[2], s->dt);
#endif
}

/* A number of a subject. */
static void put(subject *s, int word, NUMBER x)
{
  memcpy((char *)s + (size_t)word * sizeof x, &x, sizeof x);
}

static NUMBER get(const subject *s, int word)
{
  NUMBER x;
  memcpy(&x, (const char *)s + (size_t)word * sizeof x, sizeof x);
  return x;
}

/* Is that number of the state neither read nor written by the step from `before`? With another one there all the others
   are the same. */
static int is_unread(const subject *s, const generated_state *before, int word)
{
  subject other = *s, after = *s;
  other.state = *before;
  if (word >= (int)(sizeof other.state / sizeof(NUMBER))) {
    return 0;
  }
  put(&other, word, (NUMBER)0);
  put(&after, word, (NUMBER)0);
  return memcmp(before, &s->state, sizeof *before) != 0 && step(&other) == generated_ok &&
         is_sound(&other.state, sizeof other.state) && memcmp(&other, &after, sizeof other) == 0;
}

/* One step; 1: it is taken. */
static int judge_step(subject *s, int word, const char *how)
{
  const generated_state before = s->state;
  const int status = step(s);
  n_step++;
  n_refused += status != generated_ok;
  if (!is_status(status)) {
    wrong("no such status", word, how);
  } else if (status != generated_ok && memcmp(&before, &s->state, sizeof before) != 0) {
    wrong("a refused step changed the state", word, how);
  } else if (status == generated_ok && !is_sound(&s->state, sizeof s->state) && !is_unread(s, &before, word)) {
    wrong("ok with a state that is not finite", word, how);
  }
  return status == generated_ok;
}

/* What a function was to fill, with 0x5a in it before. */
static void judge_read(int status, const void *out, size_t size, const char *what, int word, const char *how)
{
  size_t kept = 0;
  while (kept < size && ((const unsigned char *)out)[kept] == 0x5a) {
    kept++;
  }
  if (!is_status(status) || (status == generated_ok ? !is_sound(out, size) : kept < size)) {
    char text[80];
    snprintf(text, sizeof text, "%s, status %d: %s", what, status,
             status == generated_ok ? "not finite" : "a refusal filled something");
    wrong(text, word, how);
  }
}

#ifndef TREE
#ifdef VARY
#define READ(f, out, ...) f(&s->model, out, __VA_ARGS__)
#else
#define READ(f, out, ...) f(out, __VA_ARGS__)
#endif

/* What reads off the state. */
static void judge_reads(const subject *s, int word, const char *how)
{
  generated_state rate;
  generated_motion motion;
  generated_node node;
  int status;
  memset(&rate, 0x5a, sizeof rate);
  memset(&motion, 0x5a, sizeof motion);
  memset(&node, 0x5a, sizeof node);
  status = READ(generated_rates_eval, &rate, &s->state, &s->input[0]);
  judge_read(status, &rate, sizeof rate, "rates", word, how);
  status = READ(generated_motion_eval, &motion, &s->state, &s->input[0]);
  judge_read(status, &motion, sizeof motion, "motion", word, how);
  if (status == generated_ok) {
    status = READ(generated_node_eval, &node, &s->state, &motion, 1);
    judge_read(status, &node, sizeof node, "node", word, how);
  }
#ifndef PRESCRIBED
  {
    generated_energy energy;
    memset(&energy, 0x5a, sizeof energy);
    status = READ(generated_energy_eval, &energy, &s->state);
    judge_read(status, &energy, sizeof energy, "energy", word, how);
  }
#endif
}
#else
static void judge_reads(const subject *s, int word, const char *how)
{
  generated_motion motion;
  generated_energy energy;
  int status;
  memset(&motion, 0x5a, sizeof motion);
  memset(&energy, 0x5a, sizeof energy);
  status = generated_motion_eval(&motion, &s->state, &s->input[0]);
  judge_read(status, &motion, sizeof motion, "motion", word, how);
  for (int body = 0; body < 3 && status == generated_ok; body++) {
    generated_node node;
    memset(&node, 0x5a, sizeof node);
    judge_read(generated_node_eval(&node, &s->state, &motion, body, 1), &node, sizeof node, "node", word, how);
  }
  status = generated_energy_eval(&energy, &s->state, &s->input[0]);
  judge_read(status, &energy, sizeof energy, "energy", word, how);
}
#endif

#ifdef generated_LANES
/* The subject in one lane, the calm one in the others: the bits of single steps. */
static void judge_lanes(const subject *s, int word, const char *how)
{
  static generated_lanes_state lanes;
  static generated_lanes_input in[3];
#ifdef VARY
  static generated_lanes_model model;
#endif
  generated_status told[generated_LANES];
  const int own = word % generated_LANES;
  for (int k = 0; k < generated_LANES; k++) {
    const subject *const from = k == own ? s : &calm;
    generated_lanes_put(&lanes, k, &from->state);
    for (int i = 0; i < 3; i++) {
      generated_lanes_copy(&in[i], &from->input[i], sizeof from->input[i], k);
    }
#ifdef VARY
    generated_lanes_put_model(&model, k, &from->model);
#endif
  }
#ifdef VARY
  (void)generated_lanes_step(&model, &lanes, &in[0], &in[1], &in[2], s->dt, told);
#else
  (void)generated_lanes_step(&lanes, &in[0], &in[1], &in[2], s->dt, told);
#endif
  for (int k = 0; k < generated_LANES; k++) {
    subject one = k == own ? *s : calm;
    generated_state found;
    one.dt = s->dt;
    generated_lanes_take(&found, &lanes, k);
    if (step(&one) != told[k] || memcmp(&found, &one.state, sizeof found) != 0) {
      wrong("a lane is not its single step", word, how);
    }
  }
}
#else
static void judge_lanes(const subject *s, int word, const char *how)
{
  (void)s, (void)word, (void)how;
}
#endif

/* All of it once, then a run until a step is refused. */
static void judge(const subject *given, int word, const char *how)
{
  subject s = *given;
  judge_reads(&s, word, how);
  judge_lanes(&s, word, how);
  for (int k = 0; k < RUN && judge_step(&s, word, how); k++) {
    judge_reads(&s, word, how);
  }
}

static void spoil_words(void)
{
  static const struct {
    const char *name;
    double value;
  } poisons[] = {{"NaN", (double)NAN},
                 {"infinity", HUGE_VAL},
                 {"-infinity", -HUGE_VAL},
                 {"largest", 0},
                 {"-largest", 0},
                 {"1e18", 1e18},
                 {"-1e18", -1e18},
                 {"1e9", 1e9},
                 {"-1e9", -1e9},
                 {"least", 0},
                 {"0", 0},
                 {"-1", -1},
                 {"1e30", 1e30},
                 {"negative", 0}};
  const NUMBER largest = sizeof(NUMBER) == 4 ? (NUMBER)3.4028234e38 : (NUMBER)1.7976931348623157e308;
  const NUMBER least = sizeof(NUMBER) == 4 ? (NUMBER)1.5e-45 : (NUMBER)5e-324;
  for (int word = 0; word < WORDS; word++) {
    for (int k = 0; k < (int)(sizeof poisons / sizeof *poisons); k++) {
      const char *const name = poisons[k].name;
      subject s = calm;
      put(&s, word,
          strcmp(name, "largest") == 0    ? largest
          : strcmp(name, "-largest") == 0 ? -largest
          : strcmp(name, "least") == 0    ? least
          : strcmp(name, "negative") == 0 ? -get(&s, word)
                                          : (NUMBER)poisons[k].value);
      judge(&s, word, name);
    }
  }
}

/* All bits, or one in an odd stride, each at the start and in the middle of a run. */
static void flip_bits(void)
{
  const int bits = WORDS * BITS, stride = bits > SAMPLE ? (bits / SAMPLE) | 1 : 1;
  subject late = calm;
  for (int k = 0; k < RUN; k++) {
    (void)judge_step(&late, 0, "calm");
  }
  for (int bit = 0; bit < bits; bit += stride) {
    for (int when = 0; when < 2; when++) {
      subject s = when ? late : calm;
      ((unsigned char *)&s)[bit / 8] = (unsigned char)(((unsigned char *)&s)[bit / 8] ^ (1u << bit % 8));
      judge(&s, bit / BITS, when ? "a bit later" : "a bit");
    }
  }
}

/* A state that moves, under loads, by a step well below its limit. */
static int prepare(void)
{
  int taken = 0;
#ifdef VARY
  if (generated_model_init(&calm.model, NULL) != generated_ok) {
    return 0;
  }
#endif
  for (calm.dt = (NUMBER)0.5; calm.dt > (NUMBER)1e-7 && !taken; calm.dt /= 2) {
    generated_start(&calm.state);
    taken = step(&calm) == generated_ok;
  }
  calm.dt /= 4;
  for (int i = 0; i < (int)(sizeof calm.input / (sizeof(NUMBER))); i++) {
    put(&calm, (int)(sizeof calm.state / sizeof(NUMBER)) + i, (NUMBER)(0.2 * sin(1 + 7.0 * i)));
  }
#ifdef TREE /* prescribed values go as their rates say */
#define MEMBER(k, member, kind)
#define LOAD(k)
#define ROTORS(k)
#define MOTOR(k)
#define MODAL(k)
#define DRIVE(k)                                                                              \
  for (int i = 0; i < 3; i++) {                                                               \
    calm.input[i].body_##k.rate[0] = (NUMBER)0.2;                                             \
    calm.input[i].body_##k.value[0] = calm.state.body_##k.x[0] + (NUMBER)(0.1 * i) * calm.dt; \
  }
#include "members.h"
#endif
  for (int k = 0; k < 200 && taken; k++) {
    taken = step(&calm) == generated_ok;
  }
  return taken;
}

int main(void)
{
  if (!prepare()) {
    printf("no start\n");
    return 1;
  }
  spoil_words();
  flip_bits();
  printf("%d %d\n", n_step, n_refused);
  return n_wrong > 0 || n_refused == 0 || n_refused == n_step;
}
