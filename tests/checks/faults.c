/* A single bit flipped: of models, integrators and states (all bits of small ones, a repeatable sample of large ones).
   Then the struct's fb_..._check sees it, or what uses the struct (a step of every integrator, motion, energy) gives a
   status, or all of it is finite: harmless here, though the numbers may be wrong. Never a crash, nor FB_OK with what is
   not finite. The check word of a model sees every flip that gives a status.
   Prints a table; exit 1 when something is not finite, or unseen. */
#include "hostile.h"

typedef struct subject {
  const char *name;
  void *at;
  size_t size;
  fb_status (*check)(void);
  fb_status (*use)(void); /* FB_OK with what is not finite: 1 */
  unsigned (*word)(void); /* NULL: it has none */
} subject;

static const fb_status not_finite = (fb_status)1;

static fb_status finite_or(fb_status status, const void *x, size_t size)
{
  return status == FB_OK && !is_finite(x, size) ? not_finite : status;
}

static unsigned body_word(void)
{
  return fb_body_crc(&w.body);
}

static unsigned system_word(void)
{
  return fb_system_crc(&w.system, &w.body, 1);
}

static unsigned exact_word(void)
{
  return fb_exact_crc(&w.exact);
}

static fb_status check_body(void)
{
  return fb_body_check(&w.body);
}

static fb_status check_state(void)
{
  return fb_state_check(&w.body, &w.state);
}

static fb_status check_exponential(void)
{
  return fb_exponential_check(&w.exponential, &w.body);
}

static fb_status check_system(void)
{
  return fb_system_check(&w.system, &w.body, 1);
}

static fb_status check_system_state(void)
{
  return fb_system_state_check(&w.system, &w.body, &w.system_state);
}

static fb_status check_exact(void)
{
  return fb_exact_check(&w.exact);
}

static fb_status check_exact_state(void)
{
  return fb_exact_state_check(&w.exact, &w.exact_state);
}

static fb_status step_body(fb_integrator integrator, fb_state *state)
{
  const fb_input *const in = &w.input;
  const fb_real dt = FB_R(0.01);
  switch (integrator) {
  case FB_INTEGRATOR_RK4:
    return fb_rk4_step(&w.body, state, &rk4_work, in, in, in, dt);
  case FB_INTEGRATOR_MIDPOINT:
    return fb_midpoint_step(&w.body, state, &implicit_work, in, dt, 0);
  case FB_INTEGRATOR_SDIRK:
    return fb_sdirk_step(&w.body, state, &implicit_work, in, in, dt, 0);
  case FB_INTEGRATOR_EXPONENTIAL:
    return fb_exponential_step(&w.body, &w.exponential, state, &exponential_work, in, in, in);
  case FB_INTEGRATOR_COUNT:
    break;
  }
  return FB_ERR_UNSUPPORTED;
}

/* The first status that is not FB_OK of a step by each integrator, motion, motion of a node, energy, momentum. */
static fb_status use_body(void)
{
  fb_state state = w.state;
  fb_motion motion;
  fb_node_motion node;
  fb_energy energy;
  fb_momentum momentum;
  fb_status status = FB_OK;
  memset(&motion, 0, sizeof motion);
  for (int k = 0; k < (int)FB_INTEGRATOR_COUNT; k++) {
    status = status ? status : step_body((fb_integrator)k, &state);
    status = finite_or(status, &state, sizeof state);
  }
  status = status ? status : fb_body_motion_eval(&w.body, &motion, &state, &w.input);
  status = finite_or(status, &motion, sizeof motion);
  status = status ? status : fb_body_node_motion_eval(&w.body, &node, &state, &motion, 1);
  status = finite_or(status, &node, sizeof node);
  status = status ? status : fb_body_energy_eval(&w.body, &energy, &state, &w.input);
  status = finite_or(status, &energy, sizeof energy);
  status = status ? status : fb_body_momentum_eval(&w.body, &momentum, &state, &w.input);
  return finite_or(status, &momentum, sizeof momentum);
}

static fb_body large; /* with lines */

static fb_status check_large(void)
{
  return fb_body_check(&large);
}

static unsigned large_word(void)
{
  return fb_body_crc(&large);
}

/* The first status that is not FB_OK of a step, motion, motion of a node, energy, momentum of another body. */
static fb_status use_other(const fb_body *other, const fb_input *input)
{
  fb_state state;
  fb_motion motion;
  fb_node_motion node;
  fb_energy energy;
  fb_momentum momentum;
  fb_status status = fb_state_init(other, &state);
  memset(&motion, 0, sizeof motion);
  state.q[0] = FB_R(0.01);
  status = status ? status : fb_rk4_step(other, &state, &rk4_work, input, input, input, FB_R(0.0001));
  status = finite_or(status, &state, sizeof state);
  status = status ? status : fb_body_motion_eval(other, &motion, &state, input);
  status = finite_or(status, &motion, sizeof motion);
  status = status ? status : fb_body_node_motion_eval(other, &node, &state, &motion, 1);
  status = finite_or(status, &node, sizeof node);
  status = status ? status : fb_body_energy_eval(other, &energy, &state, input);
  status = finite_or(status, &energy, sizeof energy);
  status = status ? status : fb_body_momentum_eval(other, &momentum, &state, input);
  return finite_or(status, &momentum, sizeof momentum);
}

static fb_status use_large(void)
{
  return use_other(&large, &w.input);
}

static fb_status check_spun(void)
{
  return fb_body_check(&w.spun);
}

static unsigned spun_word(void)
{
  return fb_body_crc(&w.spun);
}

static fb_status use_spun(void)
{
  return use_other(&w.spun, &w.spun_input);
}

static fb_status use_system(void)
{
  static fb_system_state state;
  static fb_system_motion motion;
  fb_energy energy;
  fb_status status;
  state = w.system_state;
  status = fb_system_rk4_step(&w.system, &w.body, &state, &system_work, &w.system_input, &w.system_input,
                              &w.system_input, FB_R(0.001));
  status = finite_or(status, &state, sizeof state);
  status = status ? status
                  : fb_system_sdirk_step(&w.system, &w.body, &state, &system_work, &w.system_input, &w.system_input,
                                         FB_R(0.001), 0);
  status = finite_or(status, &state, sizeof state);
  status = status ? status : fb_system_motion_eval(&w.system, &w.body, &system_work, &motion, &state, &w.system_input);
  status = finite_or(status, &motion, status == FB_OK ? sizeof motion : 0);
  status = status ? status : fb_system_energy_eval(&w.system, &w.body, &system_work, &energy, &state, &w.system_input);
  return finite_or(status, &energy, sizeof energy);
}

/* A path has no check of its own: its step refuses it. */
static fb_status check_path(void)
{
  return FB_OK;
}

/* A step along the path of steady states. */
static fb_status use_path(void)
{
  static fb_exact_state state;
  static fb_exact_path path;
  fb_status status;
  state = w.exact_state;
  path = w.exact_path;
  status = fb_exact_path_step(&w.exact, &path, &state, &path_work, &w.exact_input, &w.exact_input, FB_R(0.05));
  status = finite_or(status, &state, sizeof state);
  return finite_or(status, &path, status == FB_OK ? sizeof path : 0);
}

static fb_status use_exact(void)
{
  static fb_exact_state state;
  static fb_exact_node node[FB_MAX_EXACT + 1];
  fb_energy energy;
  fb_status status;
  state = w.exact_state;
  status = fb_exact_step(&w.exact, &state, &exact_work, &w.exact_input, FB_R(0.01));
  status = finite_or(status, &state, sizeof state);
  status = status ? status : fb_exact_nodes_eval(&w.exact, node, &state);
  status = finite_or(status, node, sizeof node);
  status = status ? status : fb_exact_energy_eval(&w.exact, &energy, &state);
  status = finite_or(status, &energy, sizeof energy);
  return status ? status : use_path();
}

#define SAMPLE 20000 /* flips of a large struct */

/* Every bit, or one in `stride` (odd, so that it comes by every bit of a word). */
static int attack(const subject *s)
{
  const size_t bits = 8 * s->size, stride = bits > SAMPLE ? bits / SAMPLE | 1 : 1;
  const unsigned word = s->word ? s->word() : 0;
  int flips = 0, detected = 0, status = 0, harmless = 0, silent = 0, words = 0, unseen = 0;
  for (size_t bit = 0; bit < bits; bit += stride) {
    unsigned char *const byte = (unsigned char *)s->at + bit / 8;
    const unsigned char was = *byte;
    *byte = (unsigned char)(was ^ (1u << bit % 8));
    flips++;
    words += s->word && s->word() != word;
    if (s->check() != FB_OK) {
      detected++;
    } else {
      const fb_status is = s->use();
      unseen += s->word && s->word() == word && is != FB_OK;
      status += is < FB_OK;
      harmless += is == FB_OK;
      silent += is > FB_OK;
    }
    *byte = was;
  }
  printf("%-16s %8d %7d %9d %7d %9d %11d", s->name, (int)bits, flips, detected, status, harmless, silent);
  if (s->word) {
    printf(" %8d\n", words);
  } else {
    printf(" %8s\n", "-");
  }
  if (unseen > 0) {
    printf("%s: %d flips that give a status are not in the check word\n", s->name, unseen);
  }
  return silent + unseen;
}

int main(void)
{
  static const subject subjects[] = {
      {"fb_body", &w.body, sizeof w.body, check_body, use_body, body_word},
      {"fb_body/lines", &large, sizeof large, check_large, use_large, large_word},
      {"fb_body/rotors", &w.spun, sizeof w.spun, check_spun, use_spun, spun_word},
      {"fb_exponential", &w.exponential, sizeof w.exponential, check_exponential, use_body, NULL},
      {"fb_state", &w.state, sizeof w.state, check_state, use_body, NULL},
      {"fb_system", &w.system, sizeof w.system, check_system, use_system, system_word},
      {"fb_system_state", &w.system_state, sizeof w.system_state, check_system_state, use_system, NULL},
      {"fb_exact", &w.exact, sizeof w.exact, check_exact, use_exact, exact_word},
      {"fb_exact_state", &w.exact_state, sizeof w.exact_state, check_exact_state, use_exact, NULL},
      {"fb_exact_path", &w.exact_path, sizeof w.exact_path, check_path, use_path, NULL}};
  static fb_exact_state state;
  fb_body_desc desc;
  int silent = 0;
  world_fill();
  desc = w.body_desc;
  desc.effects |= FB_EFFECTS_LARGE;
  if (fb_body_init(&large, &body_work, &w.natural, &desc) != FB_OK || large.lines.n_line < 1) {
    printf("no body with lines\n");
    return 1;
  }
  state = w.exact_state;
  if (fb_exact_path_step(&w.exact, &w.exact_path, &state, &path_work, NULL, &w.exact_input, FB_R(0.05)) != FB_OK) {
    printf("no path of steady states\n");
    return 1;
  }
  printf("%-16s %8s %7s %9s %7s %9s %11s %8s\n", "struct", "bits", "flips", "detected", "status", "harmless",
         "not finite", "by word");
  for (size_t k = 0; k < sizeof subjects / sizeof *subjects; k++) {
    if (subjects[k].check() != FB_OK || subjects[k].use() != FB_OK) {
      printf("%s: not well before any flip: %s, %s\n", subjects[k].name, fb_status_string(subjects[k].check()),
             fb_status_string(subjects[k].use()));
      return 1;
    }
    silent += attack(&subjects[k]);
  }
  return silent > 0;
}
