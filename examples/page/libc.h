/* libc.h - as much of the C library as the page wants where there is none: wasm32. pack.sh gives it the names of the
   standard headers. sin, cos, atan2 and exp are those of the browser's Math; sqrt, fabs and ceil are instructions. */
#ifndef PAGE_LIBC_H
#define PAGE_LIBC_H
#include <stddef.h>

#define HUGE_VAL __builtin_huge_val()
#define stderr 0
#define CLOCK_MONOTONIC 1
#define CLOCK_PROCESS_CPUTIME_ID 2

typedef int clockid_t;

struct timespec {
  long tv_sec, tv_nsec;
};

double sin(double x);
double cos(double x);
double atan2(double y, double x);
double exp(double x);
void page_refused(const char *what, const char *why); /* does not come back */

#define memcpy(to, from, n) __builtin_memcpy(to, from, n) /* instructions, too */
#define memmove(to, from, n) __builtin_memmove(to, from, n)
#define memset(to, byte, n) __builtin_memset(to, byte, n)

/* Declared for what the page does not run. */
int clock_gettime(clockid_t clock, struct timespec *t);
void qsort(void *base, size_t n, size_t size, int (*compare)(const void *, const void *));

/* What bench/check.h does with a refusal. */
#define fprintf(stream, format, what, why) page_refused(what, why)
#define exit(status) __builtin_trap()

static inline double sqrt(double x)
{
  return __builtin_sqrt(x);
}

static inline double fabs(double x)
{
  return __builtin_fabs(x);
}

static inline double ceil(double x)
{
  return __builtin_ceil(x);
}

static inline double fmax(double x, double y)
{
  return x > y || y != y ? x : y;
}

static inline int strcmp(const char *a, const char *b)
{
  while (*a && *a == *b) {
    a++, b++;
  }
  return (unsigned char)*a - (unsigned char)*b;
}

static inline int strncmp(const char *a, const char *b, size_t n)
{
  for (size_t i = 0; i < n; i++) {
    if (a[i] != b[i] || a[i] == 0) {
      return (unsigned char)a[i] - (unsigned char)b[i];
    }
  }
  return 0;
}

static inline int memcmp(const void *a, const void *b, size_t n)
{
  const unsigned char *x = a, *y = b;
  for (size_t i = 0; i < n; i++) {
    if (x[i] != y[i]) {
      return x[i] - y[i];
    }
  }
  return 0;
}
#endif
