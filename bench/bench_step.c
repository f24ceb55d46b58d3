/* bench_step - time of one rk4 step by number of modes and set of effects, CSV on stdout.
   64 bodies in different states take turns, so that neither branches nor data are learned. Each step is timed by
   itself; the time of an empty measurement is taken off. Fading and decayed bodies show what small numbers cost. */
#define _POSIX_C_SOURCE 200112L /* clock_gettime, uname */
#define FLEXBEAM_IMPLEMENTATION
#include "report.h"
#include "sets.h"
#include "../examples/common/output.h"

#define STATES 64
#define SAMPLES 20000
#define DECAYING 6 /* modes of the bodies that decay */
#define DECAYING_EFFECTS (FB_EFFECTS_FULL | FB_EFFECT_DAMPING)

static fb_body body;
static fb_state state[STATES];
static double sample[SAMPLES];
static double overhead, rigid, full; /* [ns] of an empty measurement, medians of the rigid and the full moving body */

static clock_timing measure(fb_real dt)
{
  fb_rk4_work work;
  for (int k = 0; k < SAMPLES; k++) {
    const double start = clock_ns();
    fbb_check(fb_rk4_step(&body, &state[k % STATES], &work, NULL, NULL, NULL, dt), "step");
    sample[k] = clock_ns() - start - overhead;
  }
  return clock_timing_of(sample, SAMPLES);
}

static void print(const char *name, int modes, const char *effects, const clock_timing *t)
{
  printf("%s,%d,%s,%.0f,%.0f,%.0f,%.0f,%.2f", name, modes, effects, t->lowest, t->median, t->p99, t->highest,
         t->median / rigid);
}

/* A body in motion: y and z bending modes, spin up to 1 rad/s. */
static void moving(const fbb_set *set, int y, int z)
{
  clock_timing t;
  fb_real dt;
  fbb_check(boom_craft(&body, FB_BASE_FREE, y, z, 0, set->effects, FB_R(0.01)), "body");
  dt = FB_R(0.1) * fb_rk4_limit(&body, FB_R(2.0), FB_R(10.0));
  dt = dt < FB_R(0.01) ? dt : FB_R(0.01);
  for (int k = 0; k < STATES; k++) {
    fbb_state(&state[k], &body, k, FB_R(1.0), FB_R(0.01));
  }
  t = measure(dt);
  rigid = rigid > 0.0 ? rigid : t.median;
  full = y + z == DECAYING && set->effects == DECAYING_EFFECTS ? t.median : full;
  print("moving", y + z, set->name, &t);
  printf(",\n");
}

/* Heavily damped bodies at rest: fading, caught at all stages of their decay; decayed, long after it. */
static void decaying(const char *name, int first, int next)
{
  fb_rk4_work work;
  clock_timing t;
  fb_real dt;
  fbb_check(boom_craft(&body, FB_BASE_FREE, DECAYING / 2, DECAYING / 2, 0, DECAYING_EFFECTS, FB_R(0.5)), "body");
  dt = FB_R(0.8) * fb_rk4_limit(&body, FB_R(0.0), FB_R(0.0));
  for (int k = 0; k < STATES; k++) {
    fbb_state(&state[k], &body, k, FB_R(0.0), FB_R(0.001));
    for (int i = 0; i < first + next * k; i++) {
      fbb_check(fb_rk4_step(&body, &state[k], &work, NULL, NULL, NULL, dt), "step");
    }
  }
  t = measure(dt);
  print(name, DECAYING, "full+damping", &t);
  printf(",%.2f\n", t.median / full);
}

int main(void)
{
  static const int modes[] = {1, 2, 3, 6, 12};
  output_begin("bench_step");
  overhead = fbb_begin();
  printf("# ns per step of rk4 (%.0f ns of the clock taken off), %d samples, %d states; ratio: median to that of the "
         "rigid body, and of what decays to the same body moving\n",
         overhead, SAMPLES, STATES);
  printf("case,modes,effects,min,median,p99,max,ratio,decayed/moving\n");
  moving(&fbb_sets[0], 0, 0);
  for (int k = 0; k < FBB_COUNT(modes); k++) {
    for (int set = 1; set < FBB_COUNT(fbb_sets); set++) {
      moving(&fbb_sets[set], (modes[k] + 1) / 2, modes[k] / 2);
    }
  }
  decaying("fading", 0, FB_SINGLE ? 6 : 60);
  decaying("decayed", 8000, 0);
  return 0;
}
