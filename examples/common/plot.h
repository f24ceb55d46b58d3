/* plot.h - curves from CSV files drawn by gnuplot, where it is installed. Wants popen: define _POSIX_C_SOURCE
   200809L. */
#ifndef PLOT_H
#define PLOT_H
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct curve {
  const char *file, *columns, *style, *title;
} curve;

/* path with its ending replaced: what is put beside a file */
static inline void other_name(char *name, size_t size, const char *path, const char *ending)
{
  const char *dot = strrchr(path, '.');
  const char *slash = strrchr(path, '/');
  const int n = (int)(dot && (!slash || dot > slash) ? (size_t)(dot - path) : strlen(path));
  snprintf(name, size, "%.*s%s", n, path, ending);
}

/* A name in gnuplot's quotes. */
static void put_quoted(FILE *gnuplot, const char *name)
{
  fputs("'", gnuplot);
  for (const char *p = name; *p; p++) {
    fputs(*p == '\'' ? "''" : (const char[2]){*p, 0}, gnuplot);
  }
  fputs("'", gnuplot);
}

/* gnuplot, told to draw into the file svg; NULL after a word to talk why not. */
static FILE *plot_begin(const char *svg, int width, int height, FILE *talk)
{
  FILE *gnuplot;
  if (system("gnuplot --version >/dev/null 2>&1") != 0) {
    fprintf(talk,
            "no picture: gnuplot is not installed (Debian: apt-get install gnuplot-nox); the CSV has the curves\n");
    return NULL;
  }
  gnuplot = popen("gnuplot 2>/dev/null", "w"); /* it warns of curves that are flat */
  if (!gnuplot) {
    fprintf(talk, "no picture: gnuplot did not start\n");
    return NULL;
  }
  fprintf(gnuplot, "set terminal svg size %d,%d font 'Helvetica,14' background '#ffffff'\nset output ", width, height);
  put_quoted(gnuplot, svg);
  fprintf(gnuplot,
          "\nset datafile separator ','\nset datafile commentschars '#'\nset grid\nset key above Left reverse\n"
          "set linetype 5 linecolor rgb '#8c564b'\nset xlabel 'time [s]'\n");
  return gnuplot;
}

static void plot_curves(FILE *gnuplot, const curve *curves, int n)
{
  fputs("plot \\\n", gnuplot);
  for (int k = 0; k < n; k++) {
    put_quoted(gnuplot, curves[k].file);
    fprintf(gnuplot, " using %s %s title '%s'%s\n", curves[k].columns, curves[k].style, curves[k].title,
            k + 1 < n ? ",\\" : "");
  }
}

static void plot_end(FILE *gnuplot, const char *svg, FILE *talk)
{
  fprintf(talk, pclose(gnuplot) == 0 ? "picture: %s\n" : "no picture: gnuplot refused (%s)\n", svg);
}

/* Has who read a pipe had the rows? gnuplot would wait for others. */
static inline int plot_is_piped(const curve *curves, int n)
{
  struct stat at;
  int piped = 0;
  for (int k = 0; k < n; k++) {
    piped |= stat(curves[k].file, &at) == 0 && S_ISFIFO(at.st_mode);
  }
  return piped;
}

/* Draws n curves into the file svg; settings: commands of gnuplot, each with its line end. Tells talk what it did. */
static inline void plot(const char *svg, const char *settings, const curve *curves, int n, FILE *talk)
{
  FILE *const gnuplot = plot_is_piped(curves, n) ? NULL : plot_begin(svg, 900, 520, talk);
  if (gnuplot) {
    fputs(settings, gnuplot);
    plot_curves(gnuplot, curves, n);
    plot_end(gnuplot, svg, talk);
  }
}
#endif
