/* check.h - what an example checks of itself. Define PROGRAM, its name, and include flexbeam.h before. */
#ifndef CHECK_H
#define CHECK_H
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static int misses; /* checks that failed */

/* Ends the program where the library refused. */
static inline void need(fb_status status, const char *what)
{
  if (status != FB_OK) {
    fprintf(stderr, PROGRAM ": %s: %s\n", what, fb_status_string(status));
    exit(1);
  }
}

static inline void check(const char *what, double got, double bound)
{
  const int ok = fabs(got) <= bound;
  printf("  %-62s %10.3g  at most %8.3g  %s\n", what, got, bound, ok ? "ok" : "FAILED");
  misses += !ok;
}
#endif
