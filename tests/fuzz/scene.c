/* The readers of scenes (examples/scene/scene.h, with the CSV files they name) and of campaigns
   (examples/campaign/campaign.h), and what is done with a scene that was read: its first few steps, or the choice of a
   step, its pictures. The first byte says which reader: s a scene that runs, r one that is read alone, c a campaign, j
   rows of a journal. What follows is the file; what stands behind a zero byte is any other file that it names. */
#define _POSIX_C_SOURCE 200809L /* fmemopen */
#include <stdio.h>

static FILE *fuzz_file(const char *name, const char *mode); /* in place of fopen */
#define fopen fuzz_file
#define FLEXBEAM_IMPLEMENTATION
#include "../../examples/scene/scene_run.h"
#include "../../examples/campaign/campaign_ledger.h"
#undef fopen
#include "fuzz.h"

static const uint8_t *file_data, *other_data;
static size_t file_size, other_size;

static FILE *fuzz_file(const char *name, const char *mode)
{
  const int other = strcmp(name, "FILE") != 0;
  const uint8_t *const data = other ? other_data : file_data;
  const size_t size = other ? other_size : file_size;
  if (strcmp(mode, "r") != 0) {
    return fopen("/dev/null", mode);
  }
  return size > 0 ? fmemopen((void *)(uintptr_t)data, size, "r") : NULL;
}

/* Four intervals of eight steps at most; where the step is left to the program, its choice. */
static void run_scene(scene *s)
{
  static const scene_options all = {
      .csv = "x", .linear = "x", .picture = "x", .animation = "x", .frames = "x", .n_frame = 3};
  s->duration = fmin(s->duration, 4 * s->interval);
  for (int k = 0; k < s->n_control; k++) { /* so that there are few samples, too */
    s->control[k].sample = fmax(s->control[k].sample, s->interval / 8);
  }
  if (s->step > 0 || s->duration == 0) {
    s->step = fmax(s->step, s->interval / 8);
    (void)scene_run(s, &all);
    return;
  }
  memset(&engine, 0, sizeof engine);
  if (scene_build(s, &all) == 0 && scene_start(s) == FB_OK && scene_measure_spectrum(s) == 0) {
    scene_choose(s);
  }
}

static void read_scene(int run)
{
  static scene s;
  if (scene_read(&s, "FILE", NULL, 0) != 0) {
    promise(s.message[0], "refused without a reason", "a scene");
  } else if (run) {
    run_scene(&s);
  }
}

/* Latin hypercubes of few runs: others want time and memory. */
static void read_campaign(void)
{
  static campaign c;
  double value[CAMPAIGN_VARY];
  campaign_default(&c);
  if (campaign_file(&c, "fuzz", "FILE") == 0) {
    c.latin = c.latin && c.runs > 0 && c.runs < 1000;
    if (campaign_complete(&c, "fuzz", "FILE") == 0) {
      campaign_draw(&c, value, 0);
      campaign_draw(&c, value, c.runs - 1);
    }
  }
  for (int k = 0; k < c.n_vary; k++) {
    free(c.vary[k].stratum);
  }
}

/* Lines as they are, as if their check words were right, and the file with those that it has. */
static void read_journal(void)
{
  enum { RUNS = 4, MEASURES = 2 };
  static campaign c;
  static ledger l;
  static char line[LEDGER_LINE];
  unsigned char status[RUNS] = {0};
  double measured[RUNS * MEASURES] = {0};
  char *message[RUNS] = {NULL};
  FILE *file = fuzz_file("FILE", "r");
  memset(&l, 0, sizeof l);
  c.runs = RUNS;
  l.c = &c;
  l.n_measure = MEASURES;
  l.status = status;
  l.measured = measured;
  l.message = message;
  while (file && ledger_get(file, line) != 0) {
    line[strcspn(line, "\n")] = 0;
    (void)ledger_read_row(&l, line);
  }
  promise(l.done >= 0 && l.done <= RUNS && l.failed >= 0 && l.failed <= l.done, "counts of runs", "a journal");
  for (int k = 0; k < RUNS; k++) {
    promise(status[k] < ROW_GIVEN, "a status", "a journal");
    free(message[k]);
  }
  if (file) {
    fclose(file);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  const uint8_t *end;
  if (size < 2) {
    return 0;
  }
  end = memchr(data + 1, 0, size - 1);
  file_data = data + 1;
  file_size = end ? (size_t)(end - file_data) : size - 1;
  other_data = end ? end + 1 : NULL;
  other_size = end ? size - (size_t)(other_data - data) : 0;
  if (data[0] == 'c') {
    read_campaign();
  } else if (data[0] == 'j') {
    read_journal();
  } else {
    read_scene(data[0] == 's');
  }
  return 0;
}
