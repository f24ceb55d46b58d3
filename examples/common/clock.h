/* clock.h - clocks that do not go back, and what samples of them tell. Define _POSIX_C_SOURCE 199309L before. */
#ifndef CLOCK_H
#define CLOCK_H

#include <stdlib.h>
#include <time.h>

typedef struct clock_timing { /* in the unit of the samples */
  double lowest, median, p99, highest;
} clock_timing;

static inline double clock_ns_of(clockid_t clock)
{
  struct timespec t;
  clock_gettime(clock, &t);
  return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static inline double clock_ns(void)
{
  return clock_ns_of(CLOCK_MONOTONIC);
}

/* Of this program: a run of a second is interrupted by whatever else the machine does, and that does not count. */
static inline double clock_own_ns(void)
{
  return clock_ns_of(CLOCK_PROCESS_CPUTIME_ID);
}

static inline int clock_ascending(const void *a, const void *b)
{
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Of n samples, which are sorted. */
static inline clock_timing clock_timing_of(double *sample, int n)
{
  clock_timing t;
  qsort(sample, (size_t)n, sizeof sample[0], clock_ascending);
  t.lowest = sample[0];
  t.median = sample[n / 2];
  t.p99 = sample[(int)(99L * (n - 1) / 100)];
  t.highest = sample[n - 1];
  return t;
}

#endif
