/* plot.h - curves from CSV files drawn by gnuplot, where it is installed. Wants popen: define _POSIX_C_SOURCE
   200809L. */
#ifndef PLOT_H
#define PLOT_H
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

/* Draws n curves into the file svg; settings: commands of gnuplot, each with its line end. Tells talk what it did. */
static void plot(const char *svg, const char *settings, const curve *curves, int n, FILE *talk)
{
  FILE *gnuplot;
  if (system("gnuplot --version >/dev/null 2>&1") != 0) {
    fprintf(talk,
            "no picture: gnuplot is not installed (Debian: apt-get install gnuplot-nox); the CSV has the curves\n");
    return;
  }
  gnuplot = popen("gnuplot", "w");
  if (!gnuplot) {
    fprintf(talk, "no picture: gnuplot did not start\n");
    return;
  }
  fprintf(gnuplot, "set terminal svg size 900,520 font 'Helvetica,14' background '#ffffff'\nset output ");
  put_quoted(gnuplot, svg);
  fprintf(gnuplot,
          "\nset datafile separator ','\nset datafile commentschars '#'\nset key bottom right\nset grid\n"
          "set xlabel 'time [s]'\n%splot \\\n",
          settings);
  for (int k = 0; k < n; k++) {
    put_quoted(gnuplot, curves[k].file);
    fprintf(gnuplot, " using %s %s title '%s'%s\n", curves[k].columns, curves[k].style, curves[k].title,
            k + 1 < n ? ",\\" : "");
  }
  fprintf(talk, pclose(gnuplot) == 0 ? "picture: %s\n" : "no picture: gnuplot refused (%s)\n", svg);
}
#endif
