/* same_file.h - do two names lead to the same file? Wants stat: define _POSIX_C_SOURCE 200809L. */
#ifndef SAME_FILE_H
#define SAME_FILE_H
#include <sys/stat.h>

static inline int is_file(const char *name, struct stat *at)
{
  return stat(name, at) == 0 && S_ISREG(at->st_mode);
}

static inline int same_file(const char *a, const char *b)
{
  struct stat at_a, at_b;
  return is_file(a, &at_a) && is_file(b, &at_b) && at_a.st_dev == at_b.st_dev && at_a.st_ino == at_b.st_ino;
}
#endif
