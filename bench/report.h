/* report.h - the first lines of every benchmark's output: library, machine, compiler, flags, commit. The last two come
   from the Makefile. Define _POSIX_C_SOURCE 200112L before. */
#ifndef FBB_REPORT_H
#define FBB_REPORT_H

#include "check.h"
#include "../examples/common/clock.h"
#include <sys/utsname.h>

#ifndef FBB_FLAGS
#define FBB_FLAGS "unknown"
#endif
#ifndef FBB_COMMIT
#define FBB_COMMIT "unknown"
#endif
#if defined(__clang__)
#define FBB_COMPILER __VERSION__ /* begins with its name */
#elif defined(__GNUC__)
#define FBB_COMPILER "gcc " __VERSION__
#else
#define FBB_COMPILER "unknown"
#endif

#define FBB_EMPTY 2001

/* The processor, by its name where the system tells it. */
static void fbb_print_machine(void)
{
  char line[256] = "";
  const char *name = NULL;
  struct utsname system;
  FILE *file = fopen("/proc/cpuinfo", "r");
  while (file && !name && fgets(line, sizeof line, file)) {
    name = strncmp(line, "model name", 10) == 0 ? strchr(line, ':') : NULL;
  }
  if (file) {
    fclose(file);
  }
  line[strcspn(line, "\n")] = 0;
  if (uname(&system) >= 0) {
    printf("# machine: %s,%s\n", system.machine, name ? name + 1 : " processor unknown");
  }
}

/* Prints those lines. Returns the time [ns] of an empty measurement, to be taken off short ones. */
static double fbb_begin(void)
{
  static double sample[FBB_EMPTY];
  printf("# flexbeam %s, %s, commit %s, compiler %s, flags %s\n", fb_version_string(), FB_SINGLE ? "single" : "double",
         FBB_COMMIT, FBB_COMPILER, FBB_FLAGS);
  fbb_print_machine();
  for (int k = 0; k < FBB_EMPTY; k++) {
    const double start = clock_ns();
    sample[k] = clock_ns() - start;
  }
  return clock_timing_of(sample, FBB_EMPTY).median;
}

#endif
