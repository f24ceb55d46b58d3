/* bench_advice.c - whether what the library advises is right: the eight scenes of case.h, as they are and with sizes
   drawn at random, and two of them bent far, each with three tolerances. Judged against all runs of ladder.h: is the
   tolerance met, how does the time compare with the cheapest run that meets it, and does leaving out an effect, or a
   mode, miss it. Then bodies with several appendages, several.h. Advised: by fb_advice_solve, without simulation; found: by fb_advice_search against the same
   reference. */
#define _POSIX_C_SOURCE 200112L
#define FB_MAX_EXACT 64
#define FB_MAX_MODES 20
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"

#include "advice.h"
#include "ladder.h"
#include "several.h"
#include "random.h"
#include "report.h"
#include "../examples/common/output.h"

#define FBB_RATIOS 500

typedef struct fbb_tally { /* of one kind of advice */
  int asked, met, careful; /* that a modal body can meet: met, or the exact beam called for */
  int hopeless, beyond;    /* that none can, and said so */
  int left_out, missed;    /* effects and modes left out, and how many of them miss the tolerance */
  int n_ratio, unstable;
  int large[2];             /* times large deflection was chosen: of scenes as they are, of those bent far */
  double step;              /* error of the step by what was estimated, at most */
  double ratio[FBB_RATIOS]; /* of time to the cheapest run */
} fbb_tally;

static fb_advice_work work;
static fb_real output[3 * FBB_SAMPLES], target[3 * FBB_SAMPLES];
static fbb_history history;
static int bent_far;                                                   /* the scene is */
static fb_trial asked = {0, 0, 3 * FBB_SAMPLES, 3, output, target, 1}; /* how it is run */
static const double *ns_per_s;                                         /* of the last run */

/* ---- scenes nobody tuned for */

/* Scenes that are bent by a third of the length and more: the cantilever that drops, made softer; the boom, spun up in a
   fifth of the time to twice the speed. */
static int bend_far(fbb_case *c)
{
  if (strcmp(c->name, "sag") == 0) {
    c->EI_y *= 0.5;
    c->EI_z *= 0.5;
    return 1;
  }
  if (strcmp(c->name, "spin-up") == 0) {
    c->period = 5;
    c->duration = 10;
    return 1;
  }
  return 0;
}

/* Sizes times up to 2 either way; those that deflections are powers of, or follow, by less. */
static void vary(fbb_case *c, int k)
{
  const double stiff = pow(2.0, (double)fbb_random(7 * k)), scale = pow(2.0, 0.5 * (double)fbb_random(7 * k + 1));
  c->EI_y *= stiff;
  c->EI_z *= stiff;
  c->mass *= pow(2.0, (double)fbb_random(7 * k + 2));
  c->length *= pow(1.3, (double)fbb_random(7 * k + 3));
  c->payload_mass *= pow(2.0, (double)fbb_random(7 * k + 4));
  c->hub_mass *= scale;
  c->hub_inertia *= scale;
  c->size *= c->drive == fbb_drive_joint ? 1.0 : pow(2.0, 0.5 * (double)fbb_random(7 * k + 5));
  c->period *= pow(1.5, (double)fbb_random(7 * k + 6));
}

/* ---- what a candidate does */

static double off(const fb_real *out)
{
  for (int k = 0; k < 3 * FBB_SAMPLES; k++) {
    history.out[k / 3][k % 3] = (double)out[k];
  }
  return fbb_difference(&history, &fbb_reference);
}

/* Its error, HUGE_VAL where it fails, and nanoseconds for a second. */
static double simulate(double *ns, const fb_advice *a)
{
  const fb_status status = asked.run(asked.user, output, a);
  *ns = *ns_per_s;
  return status == FB_OK ? off(output) : HUGE_VAL;
}

static void leave_out(fbb_tally *tally, const fb_advice *a, double tolerance)
{
  fb_advice less = *a;
  double ns;
  for (unsigned bit = FB_EFFECT_SPIN_COUPLING; bit <= FB_EFFECT_LARGE_DEFLECTION; bit *= 2) {
    const int needed = (a->effects & FB_EFFECT_LARGE_DEFLECTION) != 0; /* by it, all others */
    if (a->effects & bit & (needed ? (unsigned)FB_EFFECT_LARGE_DEFLECTION : (unsigned)FB_EFFECTS_FULL)) {
      less.effects = a->effects & ~bit;
      if (fb_effects_check(less.effects) != FB_OK) { /* residual inertia goes with what it needs */
        less.effects &= ~(unsigned)FB_EFFECT_RESIDUAL_INERTIA;
      }
      tally->left_out++;
      tally->missed += simulate(&ns, &less) > tolerance;
    }
  }
  less = *a;
  less.n--; /* the fastest of them */
  tally->left_out++;
  tally->missed += simulate(&ns, &less) > tolerance;
}

/* What the step alone errs by: against an eighth of it. */
static void judge_step(fbb_tally *tally, const fb_advice *a)
{
  static fb_real fine[3 * FBB_SAMPLES];
  fb_advice finer = *a;
  double difference = 0.0, size = 0.0;
  finer.dt = a->dt / 8;
  if (asked.run(asked.user, fine, &finer) != FB_OK || asked.run(asked.user, output, a) != FB_OK) {
    tally->unstable++;
    return;
  }
  for (int k = 0; k < 3 * FBB_SAMPLES; k++) {
    difference = fmax(difference, fabs((double)(fine[k] - output[k])));
    size = fmax(size, fabs((double)fine[k]));
  }
  tally->step = fmax(tally->step, difference / size / (double)a->error_step);
}

static void judge(fbb_tally *tally, const fb_advice *a, double tolerance, const char *name)
{
  const int is_large = (a->effects & FB_EFFECT_LARGE_DEFLECTION) != 0;
  const fbb_entry *const best = fbb_cheapest(tolerance);
  double ns, fastest, error = simulate(&fastest, a);
  for (int k = 0; k < 4; k++) { /* the least of five */
    error = simulate(&ns, a);
    fastest = fmin(fastest, ns);
  }
  tally->asked++;
  tally->met += error <= tolerance;
  tally->large[bent_far] += is_large;
  if (error <= tolerance && best) {
    tally->ratio[tally->n_ratio++] = fastest / best->ns_per_s;
    leave_out(tally, a, tolerance);
  }
  printf("    %-8s %s%s%s%s%s%s %d modes, %s, %.3g ms: error %.2g %%, time %.2f\n", name,
         a->effects & FB_EFFECT_SPIN_COUPLING ? "C" : "", a->effects & FB_EFFECT_RESIDUAL_INERTIA ? "R" : "",
         a->effects & FB_EFFECT_SPIN_STIFFENING ? "S" : "", a->effects & FB_EFFECT_ACCELERATION_STIFFENING ? "A" : "",
         is_large ? "L" : "", a->effects & FB_EFFECTS_FULL & ~FB_EFFECTS_LINEAR ? "," : "linear,", a->n,
         stepper_name[a->integrator], 1e3 * (double)a->dt, 100 * error, best ? fastest / best->ns_per_s : 0.0);
}

/* The cheapest run is a modal one: what is asked for exists. */
static int modes_do(const fbb_entry *e)
{
  return e && e->rung != FBB_EXACT;
}

/* Of the scene as `asked` runs it, whose target is set. */
static void ask(fbb_tally tally[2], const char *name, const fb_shape *shape, const fb_body_desc *desc,
                const fb_envelope *envelope, double tolerance)
{
  const fbb_entry *const best = fbb_cheapest(tolerance);
  fb_advice advice;
  fb_status status;
  if (modes_do(best)) {
    printf("  %5g %%  cheapest: %s, %d + %d modes, %s, %.3g ms: error %.2g %%\n", 100 * tolerance, best->level,
           best->basis.y, best->basis.z, best->integrator, 1e3 * best->dt, 100 * best->error);
  } else {
    printf("  %5g %%  cheapest: %s\n", 100 * tolerance, best ? "exact beam" : "none");
  }
  fbb_check(fb_advice_solve(&advice, &work, shape, desc, envelope, (fb_real)tolerance), name);
  if ((double)advice.error_model > tolerance) {
    printf("    advised  exact beam: modal bodies err by %.2g %%\n", 100 * (double)advice.error_model);
    tally[0].beyond += !modes_do(best);
    tally[0].asked += modes_do(best);
    tally[0].careful += modes_do(best);
  } else if (modes_do(best)) {
    judge(&tally[0], &advice, tolerance, "advised");
    judge_step(&tally[0], &advice);
  }
  status = fb_advice_search(&advice, &work, shape, desc, envelope, (fb_real)tolerance, &asked);
  if (status == FB_OK) {
    judge(&tally[1], &advice, tolerance, "found");
  } else {
    fbb_check(status == FB_ERR_CONVERGENCE ? FB_OK : status, name);
    printf("    found    nothing\n");
    tally[1].beyond += !modes_do(best);
    tally[1].asked += modes_do(best);
    tally[1].careful += modes_do(best);
  }
  tally[0].hopeless += !modes_do(best);
  tally[1].hopeless += !modes_do(best);
}

static const double tolerances[] = {0.1, 0.01, 0.001};

static void scene(fbb_tally tally[2], const fbb_case *c)
{
  static fb_shape shape;
  const fbb_basis basis = fbb_modes_of(c, c->y * FBB_ADVICE_MODES, c->z * FBB_ADVICE_MODES);
  fbb_trial trial = {c, &shape, 0.0};
  fb_body_desc desc;
  fb_envelope envelope;
  double exact_off;
  fbb_shape_make(&shape, c, &basis);
  fbb_envelope(&envelope, c);
  fbb_body_desc_make(&desc, c, FB_EFFECTS_FULL | (fbb_has_gravity(c) ? (unsigned)FB_EFFECT_GRAVITY : 0u));
  (void)fbb_climb(&exact_off, c, 1);
  for (int k = 0; k < 3 * FBB_SAMPLES; k++) {
    target[k] = (fb_real)fbb_reference.out[k / 3][k % 3];
  }
  asked.run = fbb_trial_run;
  asked.user = &trial;
  ns_per_s = &trial.ns_per_s;
  for (int k = 0; k < FBB_COUNT(tolerances); k++) {
    ask(tally, c->name, &shape, &desc, &envelope, tolerances[k]);
  }
  fflush(stdout);
}

/* ---- several appendages */

/* Runs n modes as long as it takes to trust the time; the entry has its error. */
static void climb_step(fbb_several_trial *trial, fbb_entry *e, fb_advice *a, int steps)
{
  double least = HUGE_VAL;
  a->dt = (fb_real)(trial->c->duration / FBB_SAMPLES / steps);
  history.status = FB_OK;
  for (int k = 0; k < 3 && history.status == FB_OK; k++) {
    history.status = fbb_several_run(trial, output, a);
    least = fmin(least, trial->ns_per_s);
  }
  (void)off(output);
  history.ns_per_s = least;
  e->dt = (double)a->dt;
  fbb_record(e, &history);
}

/* The first n of the modes that are missed, with every set of effects but those of half an effect, integrators, steps. */
static void climb_modes(fbb_several_trial *trial, const int *missed, int n)
{
  for (int level = 1; level < FBB_COUNT(fbb_levels); level++) {
    static fb_shape shape;
    static fb_body body;
    static fb_body_work body_work;
    fbb_entry e = {fbb_levels[level].name,
                   "",
                   fbb_levels[level].rung,
                   (int)fbb_levels[level].effects,
                   {n, 0, 0, 0, 0, 0},
                   0,
                   0,
                   0};
    fb_body_desc desc;
    fb_advice a;
    double sample = trial->c->duration / FBB_SAMPLES;
    int fewest;
    memset(&a, 0, sizeof a);
    memset(&desc, 0, sizeof desc);
    a.effects = desc.effects = fbb_levels[level].effects;
    for (int i = 0; i < trial->shape->n; i++) { /* ascending */
      for (int k = 0; k < n; k++) {
        if (missed[k] == i) {
          a.coordinate[a.n++] = i;
        }
      }
    }
    fbb_check(fb_shape_select(&shape, trial->shape, a.coordinate, a.n), trial->c->name);
    if (fb_body_init(&body, &body_work, &shape, &desc) != FB_OK) {
      continue; /* half an effect */
    }
    fewest = (int)ceil(sample / (double)fb_rk4_limit(&body, FB_R(0.0), FB_R(0.0)));
    for (int k = 0; k < (int)FB_INTEGRATOR_COUNT; k++) {
      static const int times[] = {1, 2, 3, 4, 6, 8};
      const int first = k == (int)FB_INTEGRATOR_RK4 ? fewest : 1;
      a.integrator = (fb_integrator)k;
      e.integrator = stepper_name[k];
      for (int i = 0; i < FBB_COUNT(times) && (i == 0 || first * times[i] <= 4 * fewest); i++) {
        climb_step(trial, &e, &a, first * times[i]);
      }
    }
  }
}

/* Orders the modes by simulation: the last is that without which the linear body is off by the least, then that of those
   left, and so on; error[n]: with the first n. */
static void leave_modes_out(int *missed, double *error, fbb_several_trial *trial)
{
  static fb_real best[3 * FBB_SAMPLES];
  const int n = trial->shape->n;
  fb_advice a;
  memset(&a, 0, sizeof a);
  a.effects = FB_EFFECTS_LINEAR;
  a.integrator = FB_INTEGRATOR_EXPONENTIAL;
  a.dt = (fb_real)(trial->c->duration / FBB_SAMPLES / 2);
  for (int k = 0; k < n; k++) {
    a.coordinate[k] = k;
  }
  a.n = n;
  fbb_check(fbb_several_run(trial, best, &a), trial->c->name);
  for (int k = 0; k < 3 * FBB_SAMPLES; k++) {
    fbb_reference.out[k / 3][k % 3] = (double)best[k];
  }
  error[n] = 0.0;
  for (int left = n; left > 1; left--) {
    int least = 0;
    error[left - 1] = HUGE_VAL;
    for (int k = 0; k < left; k++) {
      fb_advice less = a;
      double is;
      less.n = left - 1;
      for (int i = k; i < left - 1; i++) {
        less.coordinate[i] = a.coordinate[i + 1];
      }
      is = fbb_several_run(trial, output, &less) == FB_OK ? off(output) : HUGE_VAL;
      least = is < error[left - 1] ? k : least;
      error[left - 1] = fmin(error[left - 1], is);
    }
    missed[left - 1] = a.coordinate[least];
    for (int i = least; i < left - 1; i++) {
      a.coordinate[i] = a.coordinate[i + 1];
    }
  }
  missed[0] = a.coordinate[0];
}

static void several(fbb_tally tally[2], const fbb_several *c)
{
  static fb_shape shape;
  static fb_body body;
  static fb_body_work body_work;
  fbb_several_trial trial = {c, &shape, 0.0};
  double error[FB_MAX_MODES + 1];
  int missed[FB_MAX_MODES], last = 0;
  fb_envelope envelope;
  fb_body_desc desc;
  fb_advice all;
  printf("%s\n", c->name);
  fprintf(stderr, "%s\n", c->name);
  fbb_several_shape(&shape, c);
  fbb_several_envelope(&envelope, c);
  leave_modes_out(missed, error, &trial);

  /* Reference: all modes and effects, a short step */
  memset(&desc, 0, sizeof desc);
  memset(&all, 0, sizeof all);
  all.effects = desc.effects = FB_EFFECTS_FULL;
  all.n = shape.n;
  for (int k = 0; k < shape.n; k++) {
    all.coordinate[k] = k;
  }
  fbb_check(fb_body_init(&body, &body_work, &shape, &desc), c->name);
  all.dt = fb_rk4_limit(&body, FB_R(1.0), FB_R(0.0)) / 4;
  fbb_check(fbb_several_run(&trial, target, &all), c->name);
  for (int k = 0; k < 3 * FBB_SAMPLES; k++) {
    fbb_reference.out[k / 3][k % 3] = (double)target[k];
  }

  /* The cheapest: as few modes as meet a tolerance, and one more */
  fbb_n_entry = 0;
  for (int k = 0; k < FBB_COUNT(tolerances); k++) {
    int n = 1;
    while (n < shape.n && error[n] > tolerances[k]) {
      n++;
    }
    for (int i = n > last ? n : last + 1; i <= n + 1 && i <= shape.n; i++) {
      climb_modes(&trial, missed, i);
      last = i;
    }
  }
  qsort(fbb_entries, (size_t)fbb_n_entry, sizeof fbb_entries[0], fbb_by_cost);
  asked.run = fbb_several_run;
  asked.user = &trial;
  ns_per_s = &trial.ns_per_s;
  for (int k = 0; k < FBB_COUNT(tolerances); k++) {
    ask(tally, c->name, &shape, &desc, &envelope, tolerances[k]);
  }
  fflush(stdout);
}

static int ascending(const void *a, const void *b)
{
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static void summary(fbb_tally *t, const char *name)
{
  int within = 0;
  qsort(t->ratio, (size_t)t->n_ratio, sizeof t->ratio[0], ascending);
  for (int k = 0; k < t->n_ratio; k++) {
    within += t->ratio[k] <= 1.5;
  }
  printf("%s: of %d cases that a modal body can meet %d met, %d called too much for one, %d missed; of %d others %d "
         "called "
         "so; time of the cheapest: median %.2f, most %.2f, within 1.5 in %d of %d; leaving out an effect or a mode "
         "misses "
         "in %d of %d; large deflection in %d, of scenes bent far in %d\n",
         name, t->asked, t->met, t->careful, t->asked - t->met - t->careful, t->hopeless, t->beyond,
         t->n_ratio ? t->ratio[t->n_ratio / 2] : 0.0, t->n_ratio ? t->ratio[t->n_ratio - 1] : 0.0, within, t->n_ratio,
         t->missed, t->left_out, t->large[0], t->large[1]);
}

static void scenes(fbb_tally tally[2], int variations)
{
  for (int s = 0; s < FBB_COUNT(fbb_cases); s++) {
    for (int k = 0; k <= variations; k++) {
      fbb_case c = fbb_cases[s];
      fprintf(stderr, "%s, variation %d of %d\n", c.name, k, variations);
      if (k > 0) {
        vary(&c, FBB_COUNT(fbb_cases) * k + s);
      }
      printf("%s%s\n", c.name, k > 0 ? ", varied" : "");
      scene(tally, &c);
    }
    {
      fbb_case far = fbb_cases[s];
      bent_far = bend_far(&far);
      if (bent_far) {
        printf("%s, bent far\n", far.name);
        scene(tally, &far);
        bent_far = 0;
      }
    }
  }
}

static void summaries(fbb_tally tally[2], const char *of)
{
  char name[60];
  snprintf(name, sizeof name, "advised%s", of);
  summary(&tally[0], name);
  printf("advised steps%s: %d unstable, error at most %.2g of the estimate\n", of, tally[0].unstable, tally[0].step);
  snprintf(name, sizeof name, "found%s", of);
  summary(&tally[1], name);
}

int main(int argc, char **argv)
{
  static fbb_tally tally[2], several_tally[2];
  const int variations = argc > 1 ? atoi(argv[1]) : 2;
  output_begin("bench_advice");
  if (variations < -1 || 3 * (FBB_COUNT(fbb_cases) * (variations + 1) + 2) > FBB_RATIOS) {
    fprintf(stderr, "usage: bench_advice [variations of each scene, 0 to %d; -1: several appendages alone]\n",
            (FBB_RATIOS / 3 - 2) / FBB_COUNT(fbb_cases) - 1);
    return 1;
  }
  fbb_begin();
  if (variations >= 0) {
    scenes(tally, variations);
  }
  for (int s = 0; s < FBB_COUNT(fbb_several_cases); s++) {
    several(several_tally, &fbb_several_cases[s]);
  }
  if (variations >= 0) {
    summaries(tally, "");
  }
  summaries(several_tally, ", several appendages");
  return 0;
}
