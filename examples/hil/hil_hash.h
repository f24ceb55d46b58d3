/* hil_hash.h - SipHash-2-4 with a tag of 128 bits: a digest that only who has the key can make or check.
   Source: J.-P. Aumasson and D. J. Bernstein, "SipHash: a fast short-input PRF", 2012, and their reference
   implementation for the tag of 128 bits. Test: its 64 vectors (tests/checks/hil.c). */
#ifndef HIL_HASH_H
#define HIL_HASH_H
#include <stdint.h>

enum { HIL_KEY = 16, HIL_TAG = 16 }; /* bytes */

typedef struct hil_key {
  unsigned char byte[HIL_KEY];
} hil_key;

static inline void hil_put(unsigned char *to, uint64_t x, int bytes)
{
  for (int i = 0; i < bytes; i++) {
    to[i] = (unsigned char)(x >> (8 * i) & 255u);
  }
}

static inline uint64_t hil_get(const unsigned char *from, int bytes)
{
  uint64_t x = 0;
  for (int i = 0; i < bytes; i++) {
    x |= (uint64_t)from[i] << (8 * i);
  }
  return x;
}

static inline uint64_t hil_turn(uint64_t x, int bits)
{
  return x << bits | x >> (64 - bits);
}

static inline void hil_rounds(uint64_t v[4], int n)
{
  for (int k = 0; k < n; k++) {
    v[0] += v[1];
    v[2] += v[3];
    v[1] = hil_turn(v[1], 13) ^ v[0];
    v[3] = hil_turn(v[3], 16) ^ v[2];
    v[0] = hil_turn(v[0], 32);
    v[2] += v[1];
    v[0] += v[3];
    v[1] = hil_turn(v[1], 17) ^ v[2];
    v[3] = hil_turn(v[3], 21) ^ v[0];
    v[2] = hil_turn(v[2], 32);
  }
}

/* The tag of n bytes. */
static inline void hil_hash(unsigned char tag[HIL_TAG], const hil_key *key, const unsigned char *bytes, int n)
{
  const uint64_t k0 = hil_get(key->byte, 8), k1 = hil_get(key->byte + 8, 8);
  uint64_t v[4] = {k0 ^ 0x736f6d6570736575u, k1 ^ 0x646f72616e646f6du ^ 0xeeu, k0 ^ 0x6c7967656e657261u,
                   k1 ^ 0x7465646279746573u};
  for (int at = 0; at <= n; at += 8) { /* the last word has the length in its last byte */
    const uint64_t m = at + 8 <= n ? hil_get(bytes + at, 8) : hil_get(bytes + at, n - at) | (uint64_t)n << 56;
    v[3] ^= m;
    hil_rounds(v, 2);
    v[0] ^= m;
  }
  v[2] ^= 0xeeu;
  hil_rounds(v, 4);
  hil_put(tag, v[0] ^ v[1] ^ v[2] ^ v[3], 8);
  v[1] ^= 0xddu;
  hil_rounds(v, 4);
  hil_put(tag + 8, v[0] ^ v[1] ^ v[2] ^ v[3], 8);
}

/* 1 if two tags are the same, in a time that does not tell where they differ. */
static inline int hil_same_tag(const unsigned char a[HIL_TAG], const unsigned char b[HIL_TAG])
{
  volatile unsigned char differ = 0;
  for (int i = 0; i < HIL_TAG; i++) {
    differ = (unsigned char)(differ | (a[i] ^ b[i]));
  }
  return differ == 0;
}
#endif
