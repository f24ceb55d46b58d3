/* clock.h - the clock of the benchmarks, the order of samples, and what they were built with. Define _POSIX_C_SOURCE
   199309L before. */
#ifndef FBB_CLOCK_H
#define FBB_CLOCK_H

#include <stdlib.h>
#include <time.h>

#ifndef FBB_FLAGS
#define FBB_FLAGS "unknown"
#endif
#ifdef __VERSION__
#define FBB_COMPILER __VERSION__
#else
#define FBB_COMPILER "unknown"
#endif

static double fbb_now_ns(void)
{
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static int fbb_ascending(const void *a, const void *b)
{
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Sorts n samples. */
static void fbb_sort(double *sample, int n)
{
  qsort(sample, (size_t)n, sizeof sample[0], fbb_ascending);
}

#endif
