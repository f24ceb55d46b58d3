/* philox.h - Philox4x32-10: four random words of a counter and a key. It has no state, so that a draw depends on
   nothing but its own name.
   J.K. Salmon, M.A. Moraes, R.O. Dror and D.E. Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011. */
#ifndef PHILOX_H
#define PHILOX_H
#include <stdint.h>

static inline void philox4x32(uint32_t x[4], const uint32_t counter[4], const uint32_t key[2])
{
  uint32_t k0 = key[0], k1 = key[1];
  for (int i = 0; i < 4; i++) {
    x[i] = counter[i];
  }
  for (int round = 0; round < 10; round++) {
    const uint64_t a = (uint64_t)0xD2511F53u * x[0], b = (uint64_t)0xCD9E8D57u * x[2];
    x[0] = (uint32_t)(b >> 32) ^ x[1] ^ k0;
    x[1] = (uint32_t)b;
    x[2] = (uint32_t)(a >> 32) ^ x[3] ^ k1;
    x[3] = (uint32_t)a;
    k0 += 0x9E3779B9u; /* golden ratio */
    k1 += 0xBB67AE85u; /* sqrt(3) - 1 */
  }
}

/* Uniform in (0, 1), both ends left out: the middles of 2^52 intervals. */
static inline double philox_uniform(uint64_t seed, uint32_t index, uint32_t purpose, uint64_t name)
{
  const uint32_t counter[4] = {index, purpose, (uint32_t)name, (uint32_t)(name >> 32)};
  const uint32_t key[2] = {(uint32_t)seed, (uint32_t)(seed >> 32)};
  uint32_t x[4];
  philox4x32(x, counter, key);
  return ((double)((uint64_t)x[0] << 20 | x[1] >> 12) + 0.5) / 4503599627370496.0; /* 2^52 */
}
#endif
