/* scene_files.h - before a run: what it is to write can be written, and is neither the scene, nor what it reads, nor
   each other. Include options.h, plot.h and scene_run.h first. Wants stat: define _POSIX_C_SOURCE 200809L. */
#ifndef SCENE_FILES_H
#define SCENE_FILES_H
#include "../common/output.h"
#include "../common/same_file.h"

typedef struct scene_out {
  const char *option, *name; /* name NULL: not asked for */
  int made;                  /* it was not there before */
} scene_out;

/* Is it the scene, or a file that a word of it names? A scene from a pipe cannot be read again. */
static int scene_reads_file(const char *scene_name, const char *out)
{
  char path[512];
  const char *word;
  struct stat at;
  int reads = same_file(scene_name, out);
  text_file t;
  if (is_file(scene_name, &at) && text_try(&t, "", scene_name)) {
    while (text_line(&t)) {
      while ((word = text_word(&t)) != NULL) {
        text_beside(path, scene_name, word);
        reads |= same_file(path, out);
      }
    }
    text_close(&t);
  }
  return reads;
}

/* Opens file k of the list to append nothing: 0, or 2 after a message. */
static int scene_try_file(scene_out *out, int k, const char *scene_name)
{
  struct stat at;
  char what[128];
  const int there = lstat(out[k].name, &at) == 0;
  const int reads = scene_reads_file(scene_name, out[k].name);
  FILE *file;
  if (stat(out[k].name, &at) == 0 && S_ISFIFO(at.st_mode)) {
    return 0; /* who reads it would take the first close for its end */
  }
  file = reads ? NULL : fopen(out[k].name, "a");
  if (!file) {
    snprintf(what, sizeof what, "%s: %s", out[k].option,
             reads ? "that is the scene itself, or what it reads" : strerror(errno));
    return fail(what, out[k].name);
  }
  fclose(file);
  out[k].made = !there;
  for (int i = 0; i < k; i++) {
    if (out[i].name && same_file(out[i].name, out[k].name)) {
      snprintf(what, sizeof what, "%s and %s are the same file", out[i].option, out[k].option);
      return fail(what, out[k].name);
    }
  }
  return 0;
}

/* The folder of frames, without those of an earlier run. */
static int scene_empty_folder(const char *folder)
{
  char name[512];
  if (mkdir(folder, 0777) != 0 && errno != EEXIST) {
    return fail("cannot make the folder", folder);
  }
  for (int k = 0; k < SCENE_FRAMES; k++) {
    scene_frame_name(name, sizeof name, folder, k);
    remove(name);
  }
  return 0;
}

/* 0, or 2 after a message; curves: some are drawn beside --out; step, jacobian: files of C, or NULL. What was not there is
   not there afterwards. */
static int scene_files_check(const char *scene_name, const scene_options *o, int curves, const char *step,
                             const char *jacobian)
{
  char svg[512], bode[512], frame[512], part[OUTPUT_NAME];
  scene_out out[] = {{"--out", o->csv, 0},
                     {"--out until the run ends", NULL, 0},
                     {"curves of --out", o->csv && curves ? svg : NULL, 0},
                     {"--margins", o->margins, 0},
                     {"curves of --margins", o->margins && o->talk && output_is_plain(o->margins) ? bode : NULL, 0},
                     {"--linear", o->linear, 0},
                     {"--code", step, 0},
                     {"--jacobian", jacobian, 0},
                     {"--picture", o->picture, 0},
                     {"--animation", o->animation, 0},
                     {"--frames", o->frames ? frame : NULL, 0}};
  const int n = (int)(sizeof out / sizeof *out);
  int status = o->frames ? scene_empty_folder(o->frames) : 0;
  if (o->csv) {
    other_name(svg, sizeof svg, o->csv, ".svg");
    out[1].name = output_part(part, o->csv) && strcmp(part, o->csv) != 0 ? part : NULL;
  }
  if (o->margins) {
    other_name(bode, sizeof bode, o->margins, ".svg");
  }
  if (o->frames) {
    scene_frame_name(frame, sizeof frame, o->frames, 0);
  }
  for (int k = 0; k < n && status == 0; k++) {
    status = out[k].name ? scene_try_file(out, k, scene_name) : 0;
  }
  for (int k = 0; k < n; k++) {
    if (out[k].made) {
      remove(out[k].name);
    }
  }
  return status;
}
#endif
