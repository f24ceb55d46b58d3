/* scene_files.h - before a run: what it is to write can be written, and is neither the scene, nor what it reads, nor
   each other. Include options.h, plot.h and scene_run.h first. Wants stat: define _POSIX_C_SOURCE 200809L. */
#ifndef SCENE_FILES_H
#define SCENE_FILES_H
#include "../common/same_file.h"
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

typedef struct scene_out {
  const char *option, *name; /* name NULL: not asked for */
  int made;                  /* it was not there before */
} scene_out;

/* A file or nothing yet. A link (as /dev/stdout), a device or a pipe is written as it is, without curves. */
static int scene_is_plain(const char *name)
{
  struct stat at;
  return lstat(name, &at) != 0 || S_ISREG(at.st_mode);
}

/* Where rows go while there are not all of them, so that what is interrupted does not look whole: FILE.part. */
static const char *scene_part_name(char part[512], const char *csv)
{
  snprintf(part, 512, "%s.part", csv);
  return scene_is_plain(csv) ? part : csv;
}

/* FILE.part for this run alone: until the file that this returns is closed, after it got its name, no other run takes
   it. Negative: another one has it, of which a message tells, or it cannot be opened. flock, not fcntl: that would end
   with the first close of the rows. Where the system knows no locks there is none. */
static int scene_part_lock(const char *part)
{
  for (int attempt = 0; attempt < 10; attempt++) {
    struct stat mine, there;
    const int file = open(part, O_RDWR | O_CREAT, 0666);
    if (file < 0) {
      return -fail("cannot write", part);
    }
    if (flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      close(file);
      return -fail("--out: another run is writing it", part);
    }
    if (fstat(file, &mine) == 0 && stat(part, &there) == 0 && mine.st_ino == there.st_ino &&
        mine.st_dev == there.st_dev) {
      return file;
    }
    close(file); /* another run has given it its name meanwhile */
  }
  return -fail("--out: other runs are writing it", part);
}

/* Is it the scene, or a file that a word of it names? */
static int scene_reads_file(const char *scene_name, const char *out)
{
  char path[512];
  const char *word;
  int reads = same_file(scene_name, out);
  text_file t;
  if (text_try(&t, "", scene_name)) {
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

/* 0, or 2 after a message; curves: some are drawn beside --out; step: file of --code. What was not there is not there afterwards. */
static int scene_files_check(const char *scene_name, const scene_options *o, int curves, const char *step)
{
  char svg[512], bode[512], frame[512], part[512];
  scene_out out[] = {{"--out", o->csv, 0},
                     {"--out until the run ends", NULL, 0},
                     {"curves of --out", o->csv && curves ? svg : NULL, 0},
                     {"--margins", o->margins, 0},
                     {"curves of --margins", o->margins && o->talk && scene_is_plain(o->margins) ? bode : NULL, 0},
                     {"--linear", o->linear, 0},
                     {"--code", step, 0},
                     {"--picture", o->picture, 0},
                     {"--animation", o->animation, 0},
                     {"--frames", o->frames ? frame : NULL, 0}};
  const int n = (int)(sizeof out / sizeof *out);
  int status = o->frames ? scene_empty_folder(o->frames) : 0;
  if (o->csv) {
    other_name(svg, sizeof svg, o->csv, ".svg");
    out[1].name = scene_part_name(part, o->csv) == part ? part : NULL;
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
