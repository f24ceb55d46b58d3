/* bench_step - time of one rk4 step by number of modes and set of effects, CSV on stdout.
   64 bodies in different states take turns, so that neither branches nor data are learned. Each step is timed by
   itself; the time of an empty measurement is taken off. Fading and decayed bodies show what small numbers cost. */
#define _POSIX_C_SOURCE 199309L /* clock_gettime */
#define FLEXBEAM_IMPLEMENTATION
#include "clock.h"
#include "scene.h"

#define STATES 64
#define SAMPLES 20000

static fb_body body;
static fb_state state[STATES];
static double sample[SAMPLES];
static double overhead, rigid; /* [ns] of an empty measurement, median of the rigid body */

static void measure(fb_real dt)
{
  fb_rk4_work work;
  for (int k = 0; k < SAMPLES; k++) {
    const double start = fbb_now_ns();
    fbb_check(fb_rk4_step(&body, &state[k % STATES], &work, NULL, NULL, NULL, dt), "step");
    sample[k] = fbb_now_ns() - start - overhead;
  }
  fbb_sort(sample, SAMPLES);
}

static void print(const char *name, int modes, const char *effects)
{
  printf("%s,%d,%s,%.0f,%.0f,%.0f,%.0f,%.2f\n", name, modes, effects, sample[0], sample[SAMPLES / 2],
         sample[SAMPLES / 100 * 99], sample[SAMPLES - 1], sample[SAMPLES / 2] / rigid);
}

/* A body in motion: y and z bending modes, spin up to 1 rad/s. */
static void moving(const fbb_set *set, int y, int z)
{
  fb_real dt;
  fbb_body(&body, y, z, 0, set->effects, FB_R(0.01));
  dt = FB_R(0.1) * fb_rk4_limit(&body, FB_R(2.0), FB_R(10.0));
  dt = dt < FB_R(0.01) ? dt : FB_R(0.01);
  for (int k = 0; k < STATES; k++) {
    fbb_state(&state[k], &body, k, FB_R(1.0), FB_R(0.01));
  }
  measure(dt);
  rigid = rigid > 0.0 ? rigid : sample[SAMPLES / 2];
  print("moving", y + z, set->name);
}

/* Heavily damped bodies at rest: fading, caught at all stages of their decay; decayed, long after it. */
static void decaying(const char *name, int first, int next)
{
  fb_rk4_work work;
  fb_real dt;
  fbb_body(&body, 3, 3, 0, FB_EFFECTS_FULL | FB_EFFECT_DAMPING, FB_R(0.5));
  dt = FB_R(0.8) * fb_rk4_limit(&body, FB_R(0.0), FB_R(0.0));
  for (int k = 0; k < STATES; k++) {
    fbb_state(&state[k], &body, k, FB_R(0.0), FB_R(0.001));
    for (int i = 0; i < first + next * k; i++) {
      fbb_check(fb_rk4_step(&body, &state[k], &work, NULL, NULL, NULL, dt), "step");
    }
  }
  measure(dt);
  print(name, 6, "full+damping");
}

int main(void)
{
  static const int modes[] = {1, 2, 3, 6, 12};
  printf("# flexbeam %s, %s, compiler %s, flags %s\n", fb_version_string(), FB_SINGLE ? "single" : "double",
         FBB_COMPILER, FBB_FLAGS);
  for (int k = 0; k < SAMPLES; k++) {
    const double start = fbb_now_ns();
    sample[k] = fbb_now_ns() - start;
  }
  fbb_sort(sample, SAMPLES);
  overhead = sample[SAMPLES / 2];
  printf("# ns per step of rk4 (%.0f ns of the clock taken off), %d samples, %d states; ratio: median to that of the "
         "rigid body\n",
         overhead, SAMPLES, STATES);
  printf("case,modes,effects,min,median,p99,max,ratio\n");
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
