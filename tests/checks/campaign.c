/* The draws of a campaign: the generator's known answers, quantiles against erfc, moments and distributions of what is
   drawn (Kolmogorov and Smirnov), independence, the strata of a Latin hypercube, correlations, full factorials. */
#include "examples/campaign/campaign.h"

#define RUNS 20000

static int failures;

static void claim(int ok, const char *what, double got)
{
  if (!ok) {
    printf("campaign: %s: %.10g\n", what, got);
    failures++;
  }
}

/* Vectors of the file kat_vectors of Random123, the authors' library: counter, key, answer. */
static void generator_gives_its_known_answers(void)
{
  static const uint32_t known[3][10] = {
      {0, 0, 0, 0, 0, 0, 0x6627e8d5u, 0xe169c58du, 0xbc57ac4cu, 0x9b00dbd8u},
      {~0u, ~0u, ~0u, ~0u, ~0u, ~0u, 0x408f276du, 0x41c83b0eu, 0xa20bc7c6u, 0x6d5451fdu},
      {0x243f6a88u, 0x85a308d3u, 0x13198a2eu, 0x03707344u, 0xa4093822u, 0x299f31d0u, 0xd16cfe09u, 0x94fdccebu,
       0x5001e420u, 0x24126ea1u}};
  for (int k = 0; k < 3; k++) {
    uint32_t x[4];
    philox4x32(x, known[k], known[k] + 4);
    claim(memcmp(x, known[k] + 6, sizeof x) == 0, "known answer", k);
  }
}

static double normal_part(double z)
{
  return 0.5 * erfc(-z * sqrt(0.5));
}

static void quantile_inverts_the_distribution(void)
{
  double worst = 0;
  for (double u = 0.5; u > 1e-300; u *= 0.9) {
    worst = fmax(worst, fabs(normal_part(campaign_normal_quantile(u)) / u - 1) / (1 - log(u)));
  }
  claim(worst < 1e-15, "quantile of the normal distribution", worst); /* the condition of the tail grows with log u */
  claim(isfinite(campaign_normal_quantile(1 - 1.1102230246251565e-16)), "the last number below 1", 0);
  claim(fabs(campaign_normal_quantile(0.975) - 1.959963984540054) < 1e-14, "two-sided 5 %",
        campaign_normal_quantile(0.975));
}

static void make(campaign *c, const char *const *lines)
{
  campaign_default(c);
  claim(campaign_option(c, "campaign", "--scene", "none") == 0, "scene", 0);
  for (; *lines; lines += 2) {
    claim(campaign_option(c, "campaign", lines[0], lines[1]) == 0, lines[1], 0);
  }
  claim(campaign_complete(c, "campaign", "test") == 0, "complete", 0);
}

static double drawn[CAMPAIGN_VARY][RUNS];

static void draw_all(const campaign *c)
{
  double value[CAMPAIGN_VARY];
  for (int k = 0; k < c->runs; k++) {
    campaign_draw(c, value, k);
    for (int i = 0; i < c->n_vary; i++) {
      drawn[i][k] = value[i];
    }
  }
}

static int ascending(const void *a, const void *b)
{
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* The part of the distribution below x. */
static double part_below(const campaign_vary *v, double x)
{
  const double spread = sqrt(log1p(v->b * v->b / (v->a * v->a)));
  switch (v->kind) {
  case CAMPAIGN_NORMAL:
    return normal_part((x - v->a) / v->b);
  case CAMPAIGN_LOGNORMAL:
    return normal_part(log(x / v->a) / spread + 0.5 * spread);
  default:
    return (x - v->a) / (v->b - v->a);
  }
}

/* Kolmogorov and Smirnov: sqrt(n) D stays below 1.95 in 999 of 1000 cases. */
static double largest_distance(const campaign_vary *v, const double *x, int n)
{
  static double sorted[RUNS];
  double most = 0;
  memcpy(sorted, x, (size_t)n * sizeof *x);
  qsort(sorted, (size_t)n, sizeof *sorted, ascending);
  for (int k = 0; k < n; k++) {
    const double p = part_below(v, sorted[k]);
    most = fmax(most, fmax(p - (double)k / n, (k + 1.0) / n - p));
  }
  return sqrt(n) * most;
}

static double mean_of(const double *x, int n)
{
  double sum = 0;
  for (int k = 0; k < n; k++) {
    sum += x[k];
  }
  return sum / n;
}

static double moment_of(const double *x, const double *y, int n)
{
  const double mx = mean_of(x, n), my = mean_of(y, n);
  double sum = 0;
  for (int k = 0; k < n; k++) {
    sum += (x[k] - mx) * (y[k] - my);
  }
  return sum / n;
}

static double correlation_of(const double *x, const double *y, int n)
{
  return moment_of(x, y, n) / sqrt(moment_of(x, x, n) * moment_of(y, y, n));
}

static const char *const three[] = {
    "--runs", "20000", "--vary", "a normal -14 5%", "--vary", "b lognormal 3 0.9", "--vary", "c uniform -2 5", NULL};

/* Mean and variance within four of their standard errors. */
static void moments_are_those_asked_for(void)
{
  static campaign c;
  const double q = 1.09, lognormal = pow(q, 4) + 2 * pow(q, 3) + 3 * q * q - 3; /* q = 1 + (0.9 / 3)^2 */
  const double mean[] = {-14, 3, 1.5}, variance[] = {0.49, 0.81, 49.0 / 12}, kurtosis[] = {3, lognormal, 1.8};
  make(&c, three);
  draw_all(&c);
  for (int i = 0; i < 3; i++) {
    const double off = (mean_of(drawn[i], RUNS) - mean[i]) / sqrt(variance[i] / RUNS);
    const double wide = (moment_of(drawn[i], drawn[i], RUNS) / variance[i] - 1) / sqrt((kurtosis[i] - 1) / RUNS);
    claim(fabs(off) < 4, "standard errors of the mean", off);
    claim(fabs(wide) < 4, "standard errors of the variance", wide);
    claim(largest_distance(&c.vary[i], drawn[i], RUNS) < 1.95, "Kolmogorov and Smirnov",
          largest_distance(&c.vary[i], drawn[i], RUNS));
    claim(fabs(correlation_of(drawn[i], drawn[(i + 1) % 3], RUNS)) < 4 / sqrt(RUNS), "correlation of parameters",
          correlation_of(drawn[i], drawn[(i + 1) % 3], RUNS));
    claim(fabs(correlation_of(drawn[i], drawn[i] + 1, RUNS - 1)) < 4 / sqrt(RUNS), "correlation of runs",
          correlation_of(drawn[i], drawn[i] + 1, RUNS - 1));
  }
}

static void draws_depend_on_seed_run_and_name_alone(void)
{
  static const char *const fewer[] = {"--runs", "10", "--vary", "c uniform -2 5", NULL};
  static const char *const other[] = {"--runs", "10", "--vary", "c uniform -2 5", "--seed", "2", NULL};
  static campaign c;
  double alone, among[CAMPAIGN_VARY];
  for (int k = 9; k >= 0; k--) {
    make(&c, fewer);
    campaign_draw(&c, &alone, k);
    make(&c, three);
    campaign_draw(&c, among, k);
    claim(memcmp(&alone, &among[2], sizeof alone) == 0, "the same alone and among others, run", k);
    make(&c, other);
    campaign_draw(&c, among, k);
    claim(fabs(alone - among[0]) > 0, "another seed, another draw, run", k);
  }
}

static void latin_meets_every_stratum_once(void)
{
  static const char *const lines[] = {"--runs", "1000",         "--latin", "1",
                                      "--vary", "a normal 0 1", "--vary",  "c uniform 0 1000",
                                      "--vary", "l list 1 2",   NULL};
  static campaign c;
  static int met[2][1000];
  double error;
  make(&c, lines);
  draw_all(&c);
  for (int k = 0; k < c.runs; k++) {
    met[0][(int)(1000 * normal_part(drawn[0][k]))]++;
    met[1][(int)drawn[1][k]]++;
  }
  for (int k = 0; k < c.runs; k++) {
    claim(met[0][k] == 1 && met[1][k] == 1, "runs in a stratum", met[0][k]);
  }
  claim(fabs(correlation_of(drawn[0], drawn[1], 1000)) < 4 / sqrt(1000), "correlation of strata",
        correlation_of(drawn[0], drawn[1], 1000));
  error = mean_of(drawn[1], 1000) - 500; /* independent runs: 9 */
  claim(fabs(error) < 0.05, "the mean of a Latin hypercube", error);
}

static void correlations_are_those_asked_for(void)
{
  static const char *const lines[] = {
      "--runs",      "20000",   "--vary",      "a normal 7 2", "--vary", "b lognormal 3 0.9", "--vary", "c normal 0 1",
      "--correlate", "a b 0.8", "--correlate", "c b -0.5",     NULL};
  static const char *const wrong[] = {"--correlate", "a b 0.9", "--correlate", "c b 0.9", "--correlate", "a c -0.9"};
  static campaign c;
  make(&c, lines);
  draw_all(&c);
  for (int i = 0; i < 3; i++) {
    claim(largest_distance(&c.vary[i], drawn[i], RUNS) < 1.95, "Kolmogorov and Smirnov, correlated",
          largest_distance(&c.vary[i], drawn[i], RUNS));
  }
  for (int k = 0; k < RUNS; k++) {
    drawn[1][k] = log(drawn[1][k]);
  }
  claim(fabs(correlation_of(drawn[0], drawn[1], RUNS) - 0.8) < 4 * 0.36 / sqrt(RUNS), "0.8",
        correlation_of(drawn[0], drawn[1], RUNS));
  claim(fabs(correlation_of(drawn[2], drawn[1], RUNS) + 0.5) < 4 * 0.75 / sqrt(RUNS), "-0.5",
        correlation_of(drawn[2], drawn[1], RUNS));
  claim(fabs(correlation_of(drawn[0], drawn[2], RUNS)) < 4 / sqrt(RUNS), "0", correlation_of(drawn[0], drawn[2], RUNS));
  make(&c, three);
  campaign_option(&c, "campaign", "--vary", "c normal 0 1");
  for (int k = 0; k < 6; k += 2) {
    campaign_option(&c, "campaign", wrong[k], wrong[k + 1]);
  }
  claim(campaign_complete(&c, "(expected)", "three correlations") != 0, "a contradiction is refused", 0);
}

/* Nor do parameters that have no part in a correlation change what is drawn by it. */
static void correlated_draws_depend_on_their_own_alone(void)
{
  static const char *const pair[] = {"--vary",      "a normal 7 2", "--vary", "b lognormal 3 0.9",
                                     "--correlate", "a b 0.8",      NULL};
  static const char *const among[] = {"--vary",      "c normal 0 1",  "--vary", "a normal 7 2",
                                      "--vary",      "d uniform 0 1", "--vary", "b lognormal 3 0.9",
                                      "--correlate", "a b 0.8",       NULL};
  static campaign c;
  double alone[CAMPAIGN_VARY], more[CAMPAIGN_VARY];
  for (int k = 0; k < 100; k++) {
    make(&c, pair);
    campaign_draw(&c, alone, k);
    make(&c, among);
    campaign_draw(&c, more, k);
    claim(memcmp(&alone[0], &more[1], sizeof *alone) == 0 && memcmp(&alone[1], &more[3], sizeof *alone) == 0,
          "a correlated pair alone and among others, run", k);
  }
}

static void factorial_meets_every_combination_equally(void)
{
  static const char *const lines[] = {"--vary", "a grid 0 3 4", "--vary", "u uniform 0 1",
                                      "--vary", "b list 0 5 1", NULL};
  static campaign c;
  int met[4][6] = {{0}};
  make(&c, lines);
  claim(c.runs == 1200, "default number of runs", c.runs);
  draw_all(&c);
  for (int k = 0; k < c.runs; k++) {
    met[(int)(drawn[0][k] + 0.5)][(int)(drawn[2][k] + 0.5)]++;
  }
  for (int i = 0; i < 4; i++) {
    claim(met[i][0] == 100 && met[i][1] == 100 && met[i][5] == 100, "runs of a combination", met[i][0]);
  }
}

int main(void)
{
  generator_gives_its_known_answers();
  quantile_inverts_the_distribution();
  moments_are_those_asked_for();
  draws_depend_on_seed_run_and_name_alone();
  latin_meets_every_stratum_once();
  correlations_are_those_asked_for();
  correlated_draws_depend_on_their_own_alone();
  factorial_meets_every_combination_equally();
  return failures > 0;
}
