/* output.h - a program that ends with exit 0 has written all that it printed, and all of its files: a disk that is
   full, or a reader that has gone, is told, and makes another exit status. */
#ifndef OUTPUT_H
#define OUTPUT_H
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *output_program = "output";

/* At the end of the program, however it ends: what is still in the buffer of the standard output goes out. */
static inline void output_end(void)
{
  const int before = ferror(stdout);
  errno = 0;
  if (fflush(stdout) != 0 || before) {
    fprintf(stderr, "%s: cannot write all of the standard output%s%s\n", output_program, errno ? ": " : "",
            errno ? strerror(errno) : "");
    _Exit(1);
  }
}

/* First in main. */
static inline void output_begin(const char *program)
{
  output_program = program;
  if (atexit(output_end) != 0) {
    fprintf(stderr, "%s: its output cannot be watched\n", program);
    exit(1);
  }
}

/* ---- files: what is not whole does not look so, and costs nothing that was there. Until all of NAME is written it is
   NAME.part, which no other run takes; a link (as /dev/stdout), a device or a pipe is written as it is. Wants
   _POSIX_C_SOURCE 200809L; files of a program without are written as they are. */

#if defined _POSIX_C_SOURCE && _POSIX_C_SOURCE >= 200809L && !defined _WIN32
#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

enum { OUTPUT_FILES = 8, OUTPUT_NAME = 520 }; /* of files that a signal tells of; more are written, too */

static char output_parts[OUTPUT_FILES][OUTPUT_NAME]; /* being written; empty: a free place */

/* A file or nothing yet. */
static inline int output_is_plain(const char *name)
{
  struct stat at;
  return lstat(name, &at) != 0 || S_ISREG(at.st_mode);
}

/* Where `name` is written; 0, and errno, if that has no room. */
static inline int output_part(char part[OUTPUT_NAME], const char *name)
{
  const int n = snprintf(part, OUTPUT_NAME, "%s%s", name, output_is_plain(name) ? ".part" : "");
  errno = ENAMETOOLONG;
  return n < OUTPUT_NAME;
}

/* "; what is written of it is FILE.part", or nothing where there is none, or no file at all (NULL). */
static inline const char *output_left(const char *name)
{
  static char text[OUTPUT_NAME + 40];
  char part[OUTPUT_NAME];
  const int error = errno;
  const int is = name && output_part(part, name) && strcmp(part, name) != 0 && access(part, F_OK) == 0;
  snprintf(text, sizeof text, "%s%s", is ? "; what is written of it is " : "", is ? part : "");
  errno = error;
  return text;
}

/* By a signal: for a handler, which may use little. */
static inline void output_say(const char *text)
{
  if (write(STDERR_FILENO, text, strlen(text)) < 0) {
    return; /* nobody to tell */
  }
}

/* SIGINT and SIGTERM, where the program does not take them itself: tells what is left. An empty file is not. */
static inline void output_stop(int number)
{
  struct stat at;
  for (int k = 0; k < OUTPUT_FILES; k++) {
    if (output_parts[k][0] && stat(output_parts[k], &at) == 0 && at.st_size == 0) {
      unlink(output_parts[k]);
    } else if (output_parts[k][0]) {
      output_say(output_program);
      output_say(number == SIGINT ? ": interrupted; what is written so far is "
                                  : ": terminated; what is written so far is ");
      output_say(output_parts[k]);
      output_say("\n");
    }
  }
  _exit(128 + number);
}

static inline void output_watch(int number)
{
  struct sigaction now, then; /* one that is ignored stays so */
  memset(&then, 0, sizeof then);
  then.sa_handler = output_stop;
  if (sigaction(number, NULL, &now) == 0 && now.sa_handler == SIG_DFL) {
    sigaction(number, &then, NULL);
  }
}

/* Of that part; of "": a free one. NULL: there is none. */
static inline char *output_place(const char *part)
{
  int k = 0;
  while (k < OUTPUT_FILES && strcmp(output_parts[k], part) != 0) {
    k++;
  }
  return k < OUTPUT_FILES ? output_parts[k] : NULL;
}

static inline void output_begun(const char *part)
{
  char *const place = output_place("");
  if (place) {
    strcpy(place + 1, part + 1); /* a signal may come in between: nothing is told before the first character is there */
    place[0] = part[0];
  }
}

static inline void output_ended(const char *part)
{
  char *const place = output_place(part);
  if (place) {
    place[0] = 0;
  }
}

/* A file that nobody else has, still there under its name: 1, else errno tells why; EBUSY: another run has it. */
static inline int output_lock(int file, const char *part)
{
  struct stat mine, there;
  if (fstat(file, &mine) != 0 || !S_ISREG(mine.st_mode)) {
    errno = EEXIST;
    return 0;
  }
#ifdef LOCK_EX /* flock, not fcntl: that lock does not end with another close. Where the system knows no locks there is none. */
  if (flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    errno = EBUSY;
    return 0;
  }
#endif
  errno = EBUSY; /* another run has given it its name meanwhile */
  return lstat(part, &there) == 0 && mine.st_ino == there.st_ino && mine.st_dev == there.st_dev;
}

/* A file to be written; NULL: errno tells why. */
static inline FILE *output_open(const char *name)
{
  char part[OUTPUT_NAME];
  struct stat old;
  FILE *out;
  int file;
  if (!output_part(part, name)) {
    return NULL;
  }
  if (strcmp(part, name) == 0) {
    return fopen(name, "w");
  }
  if (access(name, F_OK) == 0 && access(name, W_OK) != 0) {
    return NULL; /* a directory that can be written would give it away */
  }
  file = open(part, O_WRONLY | O_CREAT | O_NOFOLLOW | O_NONBLOCK, 0666);
  if (file < 0) {
    return NULL;
  }
  if (!output_lock(file, part) || ftruncate(file, 0) != 0 || !(out = fdopen(file, "w"))) {
    const int error = errno;
    close(file);
    errno = error;
    return NULL;
  }
  if (stat(name, &old) == 0) {
    (void)fchmod(file, old.st_mode & 0777);
  }
  output_begun(part);
  output_watch(SIGINT);
  output_watch(SIGTERM);
  return out;
}

/* Where output_open writes `name`, if that is this file: 1. */
static inline int output_is_part(char part[OUTPUT_NAME], FILE *file, const char *name)
{
  struct stat mine, there;
  return output_part(part, name) && strcmp(part, name) != 0 && fstat(fileno(file), &mine) == 0 &&
         lstat(part, &there) == 0 && mine.st_ino == there.st_ino && mine.st_dev == there.st_dev;
}

/* Closes it, and gives it its name if all of it is there: 1; else errno tells why, where the system does. */
static inline int output_is_whole(FILE *file, const char *name)
{
  char part[OUTPUT_NAME];
  const int two = output_is_part(part, file, name);
  const int lock = two ? dup(fileno(file)) : -1; /* until it has its name */
  const int before = ferror(file);
  int whole, error;
  errno = 0;
  whole = fflush(file) == 0 && !before;
  whole = fclose(file) == 0 && whole && (!two || rename(part, name) == 0);
  error = errno;
  if (lock >= 0) {
    close(lock);
  }
  if (two) {
    output_ended(part);
  }
  errno = error;
  return whole;
}

/* Closes it before all of it is there: it keeps the name that output_left tells. */
static inline void output_leave(FILE *file, const char *name)
{
  char part[OUTPUT_NAME];
  if (output_is_part(part, file, name)) {
    output_ended(part);
  }
  fclose(file);
}

/* Closes what is not wanted any more. */
static inline void output_drop(FILE *file, const char *name)
{
  char part[OUTPUT_NAME];
  if (output_is_part(part, file, name)) {
    unlink(part);
    output_ended(part);
  }
  fclose(file);
}

static inline const char *output_why(void)
{
  return errno == EBUSY ? "another run is writing it" : strerror(errno);
}
#else
static inline FILE *output_open(const char *name)
{
  return fopen(name, "w");
}

static inline const char *output_left(const char *name)
{
  (void)name;
  return "";
}

static inline int output_is_whole(FILE *file, const char *name)
{
  const int before = ferror(file);
  (void)name;
  errno = 0;
  return fclose(file) == 0 && !before;
}

static inline void output_drop(FILE *file, const char *name)
{
  (void)name;
  fclose(file);
}

static inline const char *output_why(void)
{
  return strerror(errno);
}
#endif

/* Closes what was written: 0, or 2 after a message. */
static inline int output_close(FILE *file, const char *name)
{
  if (output_is_whole(file, name)) {
    return 0;
  }
  fprintf(stderr, "%s: cannot write %s%s%s%s\n", output_program, name, errno ? ": " : "", errno ? strerror(errno) : "",
          output_left(name));
  return 2;
}

/* In a comment of C, which it must not end, what a text was made from: without its directories, so that the same file
   gives the same text wherever it lies. */
static inline void output_source(FILE *out, const char *file)
{
  const char *const slash = strrchr(file, '/');
  for (const char *c = slash ? slash + 1 : file; *c; c++) {
    fputc(*c == '*' ? '?' : *c, out);
  }
}

#endif
