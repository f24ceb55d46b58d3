/* The readers of text files: of flexbeam reduce (model.h, with the body it builds and the header it writes), exact and
   elastodyn. The first byte says which, what follows is the file. */
#define _POSIX_C_SOURCE 200809L /* fmemopen, popen */
#define FB_MAX_MODES 5
#define FB_MAX_ELEMENTS 3
#define FB_MAX_STATIONS 6
#define FB_WITH_NONLINEAR_STRAIN 0
#define FB_MAX_EXACT 400 /* as exact */
#define FB_WITH_DETAIL 1
#define CAPACITIES_H /* not those of build/flexbeam */
#define FBI_WITH_TEXT
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"
#include <stdio.h>

static FILE *fuzz_file(const char *name, const char *mode); /* in place of fopen */
#define fopen fuzz_file
#include "../../examples/tools/model.h"
#include "../../examples/tools/exact.c"
#undef PROGRAM
#define help elastodyn_help
#include "../../examples/tools/elastodyn.c"
#undef help
#include "../../examples/tools/rom.h"
#undef fopen
#include "fuzz.h"

static const uint8_t *file_data;
static size_t file_size;

static FILE *fuzz_file(const char *name, const char *mode)
{
  (void)name;
  return strcmp(mode, "r") == 0 && file_size > 0 ? fmemopen((void *)(uintptr_t)file_data, file_size, "r") : NULL;
}

static void read_model(void)
{
  const char *what;
  FILE *out = tmpfile();
  if (model_read("fuzz", "FILE") && model_build(&what) == FB_OK && out) {
    fb_state state;
    fb_motion motion;
    promise(fb_state_init(&model_body, &state) == FB_OK, "no state", "a body from a file");
    if (fb_body_motion_eval(&model_body, &motion, &state, NULL) == FB_OK) {
      promise(all_finite(motion.acceleration, 3) && all_finite(motion.w_dot, 3) &&
                  all_finite(motion.q_ddot, model_body.n),
              "accelerations", "a body from a file");
    }
    rom_write(out, &model_body, model.name, "FILE", 0);
    rom_write(out, &model_body, model.name, "FILE", 1);
  }
  if (out) {
    fclose(out);
  }
}

/* Not its solution: tests/fuzz/api.c does that in small. */
static void read_exact(void)
{
  int modes;
  if (read_file("FILE", &modes) == 0) {
    (void)beam_start();
  }
}

static void read_elastodyn(void)
{
  static char program[] = "elastodyn", name[] = "FILE", option[] = "--length", length[] = "60";
  char *const argv[] = {program, name, option, length, NULL};
  (void)elastodyn_main(4, (char **)(uintptr_t)argv);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  if (size < 2) {
    return 0;
  }
  file_data = data + 1;
  file_size = size - 1;
  switch (data[0]) {
  case 'b':
    read_exact();
    break;
  case 'e':
    read_elastodyn();
    break;
  default:
    read_model();
  }
  return 0;
}
