/* scene.c - scenes one after the other, twice, in one process: the measures have the same bits, and nothing is
   printed. */
#include "../../examples/scene/scene_run.h"

#define RUNS 8

int main(int argc, char **argv)
{
  static scene s;
  static double first[RUNS][SCENE_MEASURES + SCENE_OUTPUTS];
  const scene_options quiet = {0};
  const int scenes = argc - 1;
  if (scenes < 1 || scenes > RUNS) {
    return 2;
  }
  for (int run = 0; run < 2 * scenes; run++) {
    const int k = run % scenes;
    double now[SCENE_MEASURES + SCENE_OUTPUTS] = {0};
    if (scene_read(&s, argv[1 + k], NULL, 0) != 0 || scene_run(&s, &quiet) != 0 || s.missed > 0) {
      printf("%s\n", s.message);
      return 1;
    }
    memcpy(now, s.measured, sizeof s.measured);
    for (int i = 0; i < s.n_reference; i++) {
      now[SCENE_MEASURES + i] = s.reference[i].difference;
    }
    if (run < scenes) {
      memcpy(first[k], now, sizeof now);
    } else if (memcmp(first[k], now, sizeof now) != 0) {
      printf("%s differs when it is run again\n", argv[1 + k]);
      return 1;
    }
  }
  return 0;
}
