/* desktop - the board of a program that runs under an operating system. */
#include "board.h"
#include "../../common/output.h"

void board_print(const char *text)
{
  static int watched;
  if (!watched++) {
    output_begin("firmware");
  }
  fputs(text, stdout);
}

void board_count_start(void)
{
}

uint32_t board_count(void)
{
  return 0;
}

uint32_t board_stack(void)
{
  return 0;
}
