/* fuzz.h - bytes become numbers, counts and spoiled words; broken promises abort. clang's -fsanitize=fuzzer brings the
   main that calls LLVMFuzzerTestOneInput; given files, the program runs those alone. */
#ifndef FUZZ_H
#define FUZZ_H
#include <limits.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

typedef struct bytes { /* what is left of the input; zeros follow */
  const uint8_t *at;
  size_t left;
} bytes;

static inline int take_byte(bytes *b)
{
  if (b->left == 0) {
    return 0;
  }
  b->left--;
  return *b->at++;
}

/* 0 .. n-1 */
static inline int take_below(bytes *b, int n)
{
  return (take_byte(b) + (n > 256 ? 256 * take_byte(b) : 0)) % n;
}

/* Plausible, at a limit, absurd, or any bits. */
static inline fb_real take_real(bytes *b)
{
  static const double list[] = {0,     1,    -1,    0.5,   2,   -0.1, 1e-3, 3,           10,       -10,  100,
                                1e-6,  1e4,  -1e4,  1e7,   1e9, 1e-9, -0.0, 1e15,        -1e15,    1e18, 1e30,
                                1e-30, 1e38, -1e38, 1e-37, 0.7, 0.02, 0.25, (double)NAN, HUGE_VAL, 1e20, -HUGE_VAL};
  const int k = take_byte(b);
  fb_real x;
  if (k < 128) {
    return (fb_real)(k - 64) / FB_R(16.0);
  }
  if (k < 128 + (int)(sizeof list / sizeof *list)) {
    return (fb_real)list[k - 128];
  }
  if (k < 250) {
    return (fb_real)((double)(take_byte(b) + 1) * (k & 1 ? 1e-3 : -1e-3) * (k & 2 ? 1e3 : 1));
  }
  for (size_t i = 0; i < sizeof x; i++) {
    ((unsigned char *)&x)[i] = (unsigned char)take_byte(b);
  }
  return x;
}

static inline int take_whole(bytes *b)
{
  static const int list[] = {-1, INT_MAX, INT_MIN, 1000, -2, 65536, 255, 300};
  const int k = take_byte(b);
  return k < 248 ? k % 12 : list[k - 248];
}

/* A moderate number, -1 to 1 times a scale. */
static inline fb_real take_part(bytes *b, double scale)
{
  return (fb_real)((take_byte(b) - 128) / 128.0 * scale);
}

/* A word of an object becomes a number or a count. */
static inline void spoil(void *at, size_t size, bytes *b)
{
  const int kind = take_byte(b);
  const size_t word = (size_t)take_byte(b) + 256 * (size_t)take_byte(b);
  if (kind & 1) {
    const int x = take_whole(b);
    if (size >= sizeof x) {
      memcpy((char *)at + word * sizeof x % (size / sizeof x * sizeof x), &x, sizeof x);
    }
  } else {
    const fb_real x = take_real(b);
    if (size >= sizeof x) {
      memcpy((char *)at + word * sizeof x % (size / sizeof x * sizeof x), &x, sizeof x);
    }
  }
}

/* Neither a NaN nor an infinity. */
static inline int all_finite(const fb_real *x, int n)
{
  for (int i = 0; i < n; i++) {
    if (!isfinite(x[i])) {
      return 0;
    }
  }
  return 1;
}

/* A promise that the header gives. */
static inline void promise(int kept_it, const char *what, const char *where)
{
  if (!kept_it) {
    fprintf(stderr, "BROKEN: %s: %s\n", where, what);
    abort();
  }
}
#endif
