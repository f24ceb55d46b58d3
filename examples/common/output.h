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

/* Closes a file that was written: 1 if all of it is there; else errno tells why, where the system does. */
static inline int output_is_whole(FILE *file)
{
  const int before = ferror(file);
  errno = 0;
  return fclose(file) == 0 && !before;
}

/* The same: 0, or 2 after a message. */
static inline int output_close(FILE *file, const char *name)
{
  if (output_is_whole(file)) {
    return 0;
  }
  fprintf(stderr, "%s: cannot write %s%s%s\n", output_program, name, errno ? ": " : "", errno ? strerror(errno) : "");
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
