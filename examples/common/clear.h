/* clear.h - large memory to zeros, or copied: what is the same already is not written, so that pages that nobody uses stay
   the system's. */
#ifndef CLEAR_H
#define CLEAR_H
#include <string.h>

static inline void clear_memory(void *memory, size_t bytes)
{
  static const unsigned char zeros[4096];
  unsigned char *const byte = (unsigned char *)memory;
  for (size_t at = 0; at < bytes; at += sizeof zeros) {
    const size_t n = bytes - at < sizeof zeros ? bytes - at : sizeof zeros;
    if (memcmp(byte + at, zeros, n) != 0) {
      memset(byte + at, 0, n);
    }
  }
}

static inline void copy_memory(void *to, const void *from, size_t bytes)
{
  const unsigned char *const source = (const unsigned char *)from;
  unsigned char *const byte = (unsigned char *)to;
  const size_t page = 4096;
  for (size_t at = 0; at < bytes; at += page) {
    const size_t n = bytes - at < page ? bytes - at : page;
    if (memcmp(byte + at, source + at, n) != 0) {
      memcpy(byte + at, source + at, n);
    }
  }
}
#endif
