/* random.h - repeatable random numbers. */
#ifndef FBB_RANDOM_H
#define FBB_RANDOM_H

#include "flexbeam.h"

/* Number k of those in (-1, 1). */
static fb_real fbb_random(int k)
{
  unsigned x = 2654435761u * (unsigned)(k + 1);
  x = ((x ^ (x >> 15)) * 2246822519u) & 0xffffffffu;
  x ^= x >> 13;
  return (fb_real)(x >> 8 & 0xffffffu) / FB_R(8388608.0) - FB_R(1.0);
}

#endif
