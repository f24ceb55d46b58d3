/* board - what firmware needs of its machine, and text without printf. desktop.c is for trying it; mps2.c for boards
   with a Cortex-M, as qemu emulates them. */
#ifndef BOARD_H
#define BOARD_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

void board_print(const char *text);

/* Instructions from the last call of board_count_start to that of board_count, the same few for the calls themselves.
   0 where nothing counts them. */
void board_count_start(void);
uint32_t board_count(void);

/* [bytes] of stack ever used; 0 where nobody knows. */
uint32_t board_stack(void);

#ifdef __cplusplus
}
#endif

static inline void board_print_unsigned(uint32_t value, int width)
{
  char text[16];
  int at = 15;
  text[at] = '\0';
  do {
    text[--at] = (char)('0' + value % 10u);
    value /= 10u;
    width--;
  } while (value > 0u);
  while (width-- > 0 && at > 0) {
    text[--at] = ' ';
  }
  board_print(text + at);
}

static inline void board_print_hex(uint32_t value)
{
  char text[9];
  for (int i = 0; i < 8; i++) {
    text[i] = "0123456789abcdef"[value >> (28 - 4 * i) & 15u];
  }
  text[8] = '\0';
  board_print(text);
}

/* thousandths / 1000 in a column of that width */
static inline void board_print_fixed(int32_t thousandths, int width)
{
  const uint32_t size = thousandths < 0 ? 0u - (uint32_t)thousandths : (uint32_t)thousandths;
  char tail[5] = {'.', (char)('0' + size / 100u % 10u), (char)('0' + size / 10u % 10u), (char)('0' + size % 10u), '\0'};
  uint32_t whole = size / 1000u;
  int digits = 1;
  for (uint32_t left = whole; left >= 10u; left /= 10u) {
    digits++;
  }
  for (int i = width - 4 - digits - (thousandths < 0); i > 0; i--) {
    board_print(" ");
  }
  board_print(thousandths < 0 ? "-" : "");
  board_print_unsigned(whole, 0);
  board_print(tail);
}

/* A digest of bits (FNV-1a by bytes, lowest first on every machine), to be continued; begin with BOARD_DIGEST. */
#define BOARD_DIGEST 2166136261u
static inline uint32_t board_digest(uint32_t digest, uint64_t bits, int bytes)
{
  for (int i = 0; i < bytes; i++) {
    digest = (digest ^ (uint32_t)(bits >> (8 * i) & 255u)) * 16777619u;
  }
  return digest;
}

#endif
