/* campaign.h - a campaign: one scene over many sets of parameters. Reads its description (campaigns/README.md lists the
   words) and draws the parameters of every run. The draws of run k of parameter NAME follow from (seed, k, NAME) alone,
   of a parameter that is correlated from those of the ones before it, too: neither the order of the runs, nor how many
   there are, nor which parameters else vary has any influence. */
#ifndef CAMPAIGN_H
#define CAMPAIGN_H
#include "philox.h"
#include "../common/text.h"
#include <float.h>

#define CAMPAIGN_VARY 32        /* parameters that vary, parameters that are set */
#define CAMPAIGN_VALUES 256     /* of a list */
#define CAMPAIGN_RUNS 100000000 /* at most */
#define CAMPAIGN_DEFAULT_RUNS 100
#define CAMPAIGN_PATH 400

typedef enum campaign_kind {
  CAMPAIGN_NORMAL,
  CAMPAIGN_LOGNORMAL,
  CAMPAIGN_UNIFORM,
  CAMPAIGN_LIST,
  CAMPAIGN_GRID
} campaign_kind;

static const char *const campaign_kinds[] = {"normal", "lognormal", "uniform", "list", "grid", NULL};

typedef struct campaign_vary {
  char name[TEXT_NAME];
  campaign_kind kind;
  double a, b;                   /* mean and standard deviation, or the ends */
  int n;                         /* values of a list or grid */
  double value[CAMPAIGN_VALUES]; /* of a list */
  int *stratum;                  /* Latin hypercube: of each run */
} campaign_vary;

typedef struct campaign {
  char scene[CAMPAIGN_PATH]; /* its file */
  int runs, latin, n_vary, n_set, n_pair, n_require;
  unsigned given; /* words so far */
  uint64_t seed;
  double cpu_limit; /* [s] of a run */
  campaign_vary vary[CAMPAIGN_VARY];
  text_named set[CAMPAIGN_VARY];
  struct {
    int a, b, line; /* of the parameters that vary; where it stands */
    double rho;
  } pair[CAMPAIGN_VARY];
  struct {
    char measure[TEXT_NAME];
    int above; /* or below */
    double limit;
  } require[CAMPAIGN_VARY];
  double root[CAMPAIGN_VARY][CAMPAIGN_VARY]; /* L of the Cholesky factors L L^T of the correlations */
} campaign;

/* FNV-1a of 64 bits, to be continued; begin with CAMPAIGN_DIGEST. */
#define CAMPAIGN_DIGEST 14695981039346656037u
static inline uint64_t campaign_digest(uint64_t digest, const char *bytes, size_t n)
{
  for (size_t i = 0; i < n; i++) {
    digest = (digest ^ (unsigned char)bytes[i]) * 1099511628211u;
  }
  return digest;
}

/* ---- draws */

/* z with Phi(z) = u for 0 < u <= 1/2: Newton's method on log Phi, which is concave; from the bound
   Phi(z) <= exp(-z^2 / 2) / 2 it climbs to the root without passing it. */
static inline double campaign_lower_quantile(double u)
{
  double z = -sqrt(-2.0 * log(2.0 * u));
  for (int k = 0; k < 40; k++) {
    const double phi_z = 0.5 * erfc(-z * 0.70710678118654752440);
    const double slope = 0.39894228040143267794 * exp(-0.5 * z * z) / phi_z;
    const double step = log(phi_z / u) / slope;
    z -= step;
    if (fabs(step) <= 1e-15 * (1.0 + fabs(z))) {
      break;
    }
  }
  return z;
}

static inline double campaign_normal_quantile(double u)
{
  return u <= 0.5 ? campaign_lower_quantile(u) : -campaign_lower_quantile(1.0 - u);
}

enum { CAMPAIGN_DRAW, CAMPAIGN_SHUFFLE }; /* what a random number is for */

/* Values of one factor of the full factorial design; 0: it is drawn. */
static inline int campaign_levels(const campaign_vary *v)
{
  return v->kind == CAMPAIGN_LIST || v->kind == CAMPAIGN_GRID ? v->n : 0;
}

static inline uint64_t campaign_name_digest(const char *name)
{
  return campaign_digest(CAMPAIGN_DIGEST, name, strlen(name));
}

/* Uniform in (0, 1); of a Latin hypercube: in the stratum of this run. */
static inline double campaign_uniform(const campaign *c, const campaign_vary *v, int run)
{
  const double u = philox_uniform(c->seed, (uint32_t)run, CAMPAIGN_DRAW, campaign_name_digest(v->name));
  return c->latin ? fmin((v->stratum[run] + u) / c->runs, 1 - 0.5 * DBL_EPSILON) : u; /* not rounded to 1 */
}

/* Strata in random order (Fisher and Yates). */
static inline void campaign_shuffle(const campaign *c, const campaign_vary *v)
{
  const uint64_t name = campaign_name_digest(v->name);
  for (int k = 0; k < c->runs; k++) {
    const int j = (int)((k + 1) * philox_uniform(c->seed, (uint32_t)k, CAMPAIGN_SHUFFLE, name));
    v->stratum[k] = v->stratum[j];
    v->stratum[j] = k;
  }
}

static inline double campaign_value(const campaign_vary *v, double u, double z, int level)
{
  double spread;
  switch (v->kind) {
  case CAMPAIGN_NORMAL:
    return v->a + v->b * z;
  case CAMPAIGN_LOGNORMAL: /* with mean a and standard deviation b */
    spread = sqrt(log1p(v->b / v->a * (v->b / v->a)));
    return v->a * exp(spread * (z - 0.5 * spread));
  case CAMPAIGN_UNIFORM:
    return v->a + (v->b - v->a) * u;
  case CAMPAIGN_LIST:
    return v->value[level];
  default:
    return v->n == 1 ? v->a : v->a + (v->b - v->a) * level / (v->n - 1);
  }
}

/* The parameters of run 0, 1, ...: those that vary, in their order. Lists and grids go through all their combinations,
   the first of them fastest. */
static inline void campaign_draw(const campaign *c, double *value, int run)
{
  double z[CAMPAIGN_VARY] = {0};
  int combination = run;
  for (int i = 0; i < c->n_vary; i++) {
    const campaign_vary *v = &c->vary[i];
    const int levels = campaign_levels(v);
    const double u = levels ? 0.5 : campaign_uniform(c, v, run);
    double mixed = 0;
    z[i] = v->kind == CAMPAIGN_NORMAL || v->kind == CAMPAIGN_LOGNORMAL ? campaign_normal_quantile(u) : 0;
    for (int j = 0; j <= i; j++) {
      mixed += c->root[i][j] * z[j];
    }
    value[i] = campaign_value(v, u, mixed, levels ? combination % levels : 0);
    combination /= levels ? levels : 1;
  }
}

/* ---- the description */

/* A standard deviation, or that part of the mean, as in 5%. */
static inline double campaign_deviation(text_file *t, double mean)
{
  char *const word = t->at + strspn(t->at, " ");
  const size_t n = strcspn(word, " ");
  const int percent = n > 1 && word[n - 1] == '%';
  double deviation;
  if (percent) {
    word[n - 1] = ' ';
  }
  deviation = text_number(t, "standard deviation");
  deviation = percent ? fabs(mean) * deviation / 100 : deviation;
  if (!t->failed && !(deviation > 0)) {
    text_fail(t, "the standard deviation must be greater than 0");
  }
  return deviation;
}

/* What stands after the name and the kind. */
static inline void campaign_distribution(text_file *t, campaign_vary *v)
{
  switch (v->kind) {
  case CAMPAIGN_NORMAL:
  case CAMPAIGN_LOGNORMAL:
    v->a = text_number(t, "mean");
    v->b = campaign_deviation(t, v->a);
    if (v->kind == CAMPAIGN_LOGNORMAL && !(v->a > 0)) {
      text_fail(t, "the mean of a lognormal distribution must be greater than 0");
    }
    break;
  case CAMPAIGN_LIST:
    while (text_more(t) || v->n == 0) {
      if (v->n == CAMPAIGN_VALUES) {
        text_fail(t, "more than %d values", CAMPAIGN_VALUES);
        break;
      }
      v->value[v->n++] = text_number(t, "value");
    }
    break;
  default:
    v->a = text_number(t, "lower end");
    v->b = text_number(t, "upper end");
    if (!(v->a < v->b)) {
      text_fail(t, "the lower end must be below the upper one");
    }
    if (v->kind == CAMPAIGN_GRID) {
      v->n = text_whole(t, "number of values", 2, CAMPAIGN_RUNS);
    }
  }
}

/* The place of a parameter among those that vary; -1: it does not. */
static inline int campaign_find(const campaign *c, const char *name)
{
  for (int i = 0; i < c->n_vary; i++) {
    if (strcmp(c->vary[i].name, name) == 0) {
      return i;
    }
  }
  return -1;
}

/* The place of a parameter among those that are set; -1: it is not. */
static inline int campaign_find_set(const campaign *c, const char *name)
{
  for (int i = 0; i < c->n_set; i++) {
    if (strcmp(c->set[i].name, name) == 0) {
      return i;
    }
  }
  return -1;
}

/* The place for a parameter of which there are n, or -1 after a complaint. The command line replaces what a file
   says. */
static inline int campaign_place(text_file *t, const char *name, int found, int found_in_other, int *n)
{
  if (found_in_other >= 0 || (found >= 0 && t->line > 0)) {
    text_fail(t, "%s is there twice", name);
  } else if (found < 0 && *n == CAMPAIGN_VARY) {
    text_fail(t, "more than %d parameters", CAMPAIGN_VARY);
  }
  if (t->failed) {
    return -1;
  }
  return found >= 0 ? found : (*n)++;
}

/* set NAME VALUE */
static inline void campaign_set(campaign *c, text_file *t)
{
  char name[TEXT_NAME] = "";
  int k;
  text_name(t, "a parameter", name);
  k = campaign_place(t, name, campaign_find_set(c, name), campaign_find(c, name), &c->n_set);
  if (k >= 0) {
    strcpy(c->set[k].name, name);
    c->set[k].value = text_number(t, "value");
  }
}

/* vary NAME KIND ... */
static inline void campaign_varies(campaign *c, text_file *t)
{
  char name[TEXT_NAME] = "";
  int k, kind;
  text_name(t, "a parameter", name);
  k = campaign_place(t, name, campaign_find(c, name), campaign_find_set(c, name), &c->n_vary);
  kind = text_choice(t, "how it varies", campaign_kinds);
  if (!t->failed) {
    memset(&c->vary[k], 0, sizeof c->vary[k]);
    strcpy(c->vary[k].name, name);
    c->vary[k].kind = (campaign_kind)kind;
    campaign_distribution(t, &c->vary[k]);
  }
}

/* correlate NAME NAME RHO: of normal scores, that is of the values if normal, of their logarithms if lognormal. */
static inline void campaign_correlate(campaign *c, text_file *t)
{
  char name[2][TEXT_NAME] = {"", ""};
  int at[2], k = 0;
  if (c->n_pair == CAMPAIGN_VARY) {
    text_fail(t, "more than %d correlations", CAMPAIGN_VARY);
    return;
  }
  for (int i = 0; i < 2; i++) {
    text_name(t, "a parameter", name[i]);
    at[i] = campaign_find(c, name[i]);
    if (at[i] < 0) {
      text_fail(t, "no parameter that varies has the name %s before this line", name[i]);
      return;
    }
  }
  while (k < c->n_pair && (c->pair[k].a != at[0] || c->pair[k].b != at[1]) &&
         (c->pair[k].a != at[1] || c->pair[k].b != at[0])) {
    k++;
  }
  if (k < c->n_pair && t->line > 0) {
    text_fail(t, "%s and %s are correlated twice", name[0], name[1]);
  }
  c->pair[k].a = at[0];
  c->pair[k].b = at[1];
  c->pair[k].line = t->line;
  c->pair[k].rho = text_number(t, "correlation");
  if (at[0] == at[1] || !(fabs(c->pair[k].rho) < 1)) {
    text_fail(t, "a correlation is that of two parameters, between -1 and 1");
  }
  c->n_pair += k == c->n_pair;
}

/* require MEASURE above|below LIMIT */
static inline void campaign_require(campaign *c, text_file *t)
{
  static const char *const sides[] = {"below", "above", NULL};
  if (c->n_require == CAMPAIGN_VARY) {
    text_fail(t, "more than %d requirements", CAMPAIGN_VARY);
    return;
  }
  text_name(t, "a measure", c->require[c->n_require].measure);
  c->require[c->n_require].above = text_choice(t, "a requirement", sides);
  c->require[c->n_require].limit = text_number(t, "limit");
  c->n_require++;
}

/* The path of a file as seen from another; 0: it is too long. */
static inline int campaign_beside(char path[CAMPAIGN_PATH], const char *from, const char *name)
{
  const char *slash = name[0] == '/' ? NULL : strrchr(from, '/');
  return snprintf(path, CAMPAIGN_PATH, "%.*s%s", slash ? (int)(slash + 1 - from) : 0, from, name) < CAMPAIGN_PATH;
}

/* scene FILE: as seen from the file that says so, or from the working directory. */
static inline void campaign_scene(campaign *c, text_file *t)
{
  const char *word = text_word(t);
  if (!word) {
    text_fail(t, "the name of a file is missing");
  } else if (!campaign_beside(c->scene, t->line > 0 ? t->name : "", word)) {
    text_fail(t, "a path of more than %d characters", CAMPAIGN_PATH - 1);
  }
}

static inline void campaign_seed(campaign *c, text_file *t)
{
  const double seed = text_number(t, "seed");
  if (!t->failed && (seed != floor(seed) || seed < 0 || seed > 9007199254740992.0)) {
    text_fail(t, "seed must be a whole number from 0 to 2^53");
  }
  c->seed = t->failed ? 0 : (uint64_t)seed;
}

enum { CAMPAIGN_WORDS = 9 };

/* The place of a word of the description; CAMPAIGN_WORDS: it is none. */
static inline int campaign_word(const char *word)
{
  static const char *const words[] = {"scene", "runs", "seed",      "latin",   "cpu_limit",
                                      "vary",  "set",  "correlate", "require", NULL};
  int k = 0;
  while (words[k] && strcmp(word, words[k]) != 0) {
    k++;
  }
  return k;
}

/* A line of the file, or an option of the command line with the same words, which overrides what the file says. */
static inline void campaign_line(campaign *c, text_file *t, const char *word)
{
  enum { SCENE, RUNS, SEED, LATIN, CPU_LIMIT, VARY, SET, CORRELATE, REQUIRE };
  const int k = campaign_word(word);
  if (k < VARY && t->line > 0 && (c->given & 1u << k)) {
    text_fail(t, "%s is there twice", word);
  }
  c->given |= 1u << k;
  if (k == SCENE) {
    campaign_scene(c, t);
  } else if (k == RUNS) {
    c->runs = text_whole(t, word, 1, CAMPAIGN_RUNS);
  } else if (k == SEED) {
    campaign_seed(c, t);
  } else if (k == LATIN) {
    c->latin = text_more(t) ? text_whole(t, word, 0, 1) : 1;
  } else if (k == CPU_LIMIT) {
    c->cpu_limit = text_number(t, word);
    if (!(c->cpu_limit >= 0.01 && c->cpu_limit <= 1e6)) {
      text_fail(t, "cpu_limit must be 0.01 to 1e6 s");
    }
  } else if (k == VARY) {
    campaign_varies(c, t);
  } else if (k == SET) {
    campaign_set(c, t);
  } else if (k == CORRELATE) {
    campaign_correlate(c, t);
  } else if (k == REQUIRE) {
    campaign_require(c, t);
  } else {
    text_fail(t, "no such word for a campaign: %s", word);
  }
  text_end_of_line(t);
}

/* L of the correlations: L L^T = R, row by row. */
static inline void campaign_factor(campaign *c, text_file *t)
{
  double(*L)[CAMPAIGN_VARY] = c->root;
  memset(c->root, 0, sizeof c->root);
  for (int i = 0; i < c->n_vary; i++) {
    L[i][i] = 1;
  }
  for (int k = 0; k < c->n_pair; k++) {
    const int a = c->pair[k].a, b = c->pair[k].b;
    L[a > b ? a : b][a > b ? b : a] = c->pair[k].rho;
  }
  for (int i = 0; i < c->n_vary; i++) {
    for (int j = 0; j <= i; j++) {
      for (int k = 0; k < j; k++) {
        L[i][j] -= L[i][k] * L[j][k];
      }
      if (j < i) {
        L[i][j] /= L[j][j];
      }
    }
    if (!(L[i][i] > 1e-12)) {
      text_fail(t, "the correlations contradict each other (at %s)", c->vary[i].name);
      return;
    }
    L[i][i] = sqrt(L[i][i]);
  }
}

static inline void campaign_check_pairs(const campaign *c, text_file *t)
{
  for (int k = 0; k < c->n_pair; k++) {
    const campaign_vary *a = &c->vary[c->pair[k].a], *b = &c->vary[c->pair[k].b];
    t->line = c->pair[k].line;
    if (a->kind > CAMPAIGN_LOGNORMAL || b->kind > CAMPAIGN_LOGNORMAL) {
      text_fail(t, "%s and %s must both vary normal or lognormal to be correlated", a->name, b->name);
    } else if (c->latin) {
      text_fail(t, "correlate would take the runs out of the strata of latin: one or the other");
    }
  }
  t->line = 0; /* what is wrong with the whole has no line */
}

/* How many there are; all combinations of lists and grids are there equally often. */
static inline void campaign_count(campaign *c, text_file *t)
{
  double combinations = 1, runs;
  int drawn = 0;
  for (int i = 0; i < c->n_vary; i++) {
    const int levels = campaign_levels(&c->vary[i]);
    combinations *= levels ? levels : 1;
    drawn += levels == 0;
  }
  runs = c->runs > 0 ? c->runs : combinations * (drawn ? CAMPAIGN_DEFAULT_RUNS : 1);
  if (runs > CAMPAIGN_RUNS) {
    text_fail(t, "%.0f combinations of lists and grids are too many", combinations);
  } else if (fmod(runs, combinations) > 0) {
    text_fail(t, "runs must be a multiple of %.0f, the combinations of lists and grids", combinations);
  }
  c->runs = t->failed ? 0 : (int)runs;
}

static inline void campaign_stratify(campaign *c, text_file *t)
{
  for (int i = 0; i < c->n_vary && c->latin && !t->failed; i++) {
    campaign_vary *v = &c->vary[i];
    if (campaign_levels(v)) {
      continue;
    }
    v->stratum = malloc((size_t)c->runs * sizeof(int));
    if (v->stratum) {
      campaign_shuffle(c, v);
    } else {
      text_fail(t, "no memory for the strata of %d runs", c->runs);
    }
  }
}

/* What only the whole description tells; fills in what was left out. */
static inline void campaign_check(campaign *c, text_file *t)
{
  t->line = 0;
  if (!c->scene[0]) {
    text_fail(t, "no scene is named");
  } else if (c->n_vary == 0) {
    text_fail(t, "no parameter varies");
  }
  campaign_check_pairs(c, t);
  campaign_factor(c, t);
  campaign_count(c, t);
  campaign_stratify(c, t);
}
/* ---- from where it comes */

static inline void campaign_default(campaign *c)
{
  memset(c, 0, sizeof *c);
  c->seed = 1;
  c->cpu_limit = 3600;
}

/* A line given as an option --WORD TEXT; 0, or 2 after a complaint. */
static inline int campaign_option(campaign *c, const char *program, const char *option, const char *text)
{
  text_file t;
  memset(&t, 0, sizeof t);
  t.program = program;
  t.name = option;
  t.at = t.buffer;
  if (snprintf(t.buffer, sizeof t.buffer, "%s", text) >= (int)sizeof t.buffer) {
    text_fail(&t, "more than %d characters", (int)sizeof t.buffer - 1);
  } else {
    campaign_line(c, &t, option + 2);
  }
  return t.failed ? 2 : 0;
}

static inline int campaign_file(campaign *c, const char *program, const char *path)
{
  text_file t;
  if (text_open(&t, program, path)) {
    while (text_line(&t)) {
      campaign_line(c, &t, text_word(&t));
    }
    text_close(&t);
  }
  return t.failed ? 2 : 0;
}

/* When all lines are there. */
static inline int campaign_complete(campaign *c, const char *program, const char *name)
{
  text_file t;
  memset(&t, 0, sizeof t);
  t.program = program;
  t.name = name;
  campaign_check(c, &t);
  return t.failed ? 2 : 0;
}
#endif
