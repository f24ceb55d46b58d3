/* Writes the body of a ROM header again; check-rom compares the two. */
#define FBI_WITH_TEXT
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"
#include "rom.h"
#include "../../examples/tools/rom.h"

int main(void)
{
  rom_write(stdout, &rom_body, "rom_body", SOURCE, FB_SINGLE);
  return 0;
}
