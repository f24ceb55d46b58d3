/* scene_curves.h - pictures of the rows of a scene and of the loops of its controllers, by gnuplot. Include plot.h and
   scene_run.h first.

   A panel has outputs of one unit and of one size: the largest that has no panel yet, and those that reach a thirtieth of
   it; what is zero all the time stands with the largest. A panel has at most 6 curves: their keys have room beside it.
   The margin for keys is as wide as the longest name wants. */
#ifndef SCENE_CURVES_H
#define SCENE_CURVES_H

#define PANEL_RATIO 30.0
#define PANEL_CURVES 6
#define PANEL_FLAT 1e-6 /* of its size: what varies by less is drawn as a constant, its rounding is not enlarged */

static double curve_size(int output)
{
  return fmax(fabs(engine.lowest[output]), fabs(engine.highest[output]));
}

/* The largest output of that one's unit that has no panel. */
static int panel_largest(const scene *s, const int *panel, int first)
{
  int largest = first;
  for (int k = first + 1; k < s->n_output; k++) {
    if (panel[k] < 0 && strcmp(s->output[k].unit, s->output[first].unit) == 0 && curve_size(k) > curve_size(largest)) {
      largest = k;
    }
  }
  return largest;
}

/* The panel of each output; returns how many there are. */
static int panels_assign(const scene *s, int *panel)
{
  int n = 0;
  for (int k = 0; k < s->n_output; k++) {
    panel[k] = -1;
  }
  for (int first = 0; first < s->n_output; first++) {
    while (panel[first] < 0) {
      const double size = curve_size(panel_largest(s, panel, first));
      int count = 0;
      for (int k = first; k < s->n_output && count < PANEL_CURVES; k++) {
        const int fits = curve_size(k) >= size / PANEL_RATIO || !(curve_size(k) > 0);
        if (panel[k] < 0 && fits && strcmp(s->output[k].unit, s->output[first].unit) == 0) {
          panel[k] = n;
          count++;
        }
      }
      n++;
    }
  }
  return n;
}

/* A key beside the panels: the width of a picture whose longest name has so many letters. */
static int key_width(int letters)
{
  return 735 + 13 * letters;
}

static void key_place(FILE *gnuplot, int letters)
{
  const double width = key_width(letters);
  fprintf(gnuplot,
          "set key at graph 1.015, graph 1 left top vertical Left reverse samplen 2 noenhanced\n"
          "set lmargin at screen %.6g\nset rmargin at screen %.6g\nset format '%%.8g'\n",
          130 / width, 650 / width);
}

/* Outputs of one panel. What is constant would have ticks that are all the same. */
static void draw_panel(FILE *gnuplot, const scene *s, const char *csv, const int *panel, int shown)
{
  static curve curves[SCENE_OUTPUTS];
  static char columns[SCENE_OUTPUTS][16];
  const char *unit = "";
  char label[40];
  double low = HUGE_VAL, high = -HUGE_VAL, size;
  int n = 0;
  for (int k = 0; k < s->n_output; k++) {
    if (panel[k] == shown) {
      snprintf(columns[n], sizeof columns[n], "1:%d", k + 2);
      curves[n] = (curve){csv, columns[n], "with lines linewidth 1.5", s->output[k].label};
      n++;
      low = fmin(low, engine.lowest[k]);
      high = fmax(high, engine.highest[k]);
      unit = s->output[k].unit;
    }
  }
  size = fmax(fabs(low), fabs(high));
  if (high - low > PANEL_FLAT * size) {
    fputs("set yrange [*:*]\n", gnuplot);
  } else {
    const double around = size > 0 ? 0.01 * size : 1;
    fprintf(gnuplot, "set yrange [%.12g:%.12g]\n", low - around, high + around);
  }
  snprintf(label, sizeof label, "[%s]", unit);
  fputs("set ylabel ", gnuplot);
  put_quoted(gnuplot, label);
  fputs(" noenhanced\n", gnuplot);
  plot_curves(gnuplot, curves, n);
}

/* Curves of the outputs, panels below each other over the same time. */
static void draw_curves(const scene *s, const char *csv)
{
  int panel[SCENE_OUTPUTS], longest = 0;
  const int n = panels_assign(s, panel);
  char svg[512];
  FILE *gnuplot;
  for (int k = 0; k < s->n_output; k++) {
    longest = (int)fmax(longest, (double)strlen(s->output[k].label));
  }
  other_name(svg, sizeof svg, csv, ".svg");
  gnuplot = plot_begin(svg, key_width(longest), n > 1 ? 30 + 220 * n : 520, stdout);
  if (gnuplot) {
    key_place(gnuplot, longest);
    fprintf(gnuplot,
            "set autoscale xfix\nset offsets 0, 0, graph 0.05, graph 0.05\nunset xlabel\nset tmargin 1\nset bmargin "
            "3\nset multiplot layout %d,1\n",
            n);
    for (int k = 0; k < n; k++) {
      fputs(k + 1 == n ? "set xlabel 'time [s]'\n" : "", gnuplot);
      draw_panel(gnuplot, s, csv, panel, k);
    }
    plot_end(gnuplot, svg, stdout);
  }
}

/* ---- Bode and Nyquist */

/* A margin in a picture: a point of the key, and points and a line from what is critical to the loop. */
typedef struct margin_mark {
  char text[96];
  int symbol;                                /* of gnuplot: square, circle, triangle */
  double omega, dB, critical, phase, re, im; /* critical: the phase of -1 that is next to the loop's, [deg] */
} margin_mark;

/* The margins of a loop that it has: of gain above 1 and below, of phase. */
static int margin_marks(margin_mark *mark, const loop_margins *m)
{
  const double factor[2] = {m->gain, m->reduction}, at[2] = {m->gain_at, m->reduction_at};
  int n = 0;
  if (m->radius > 1 + 1e-6) {
    return 0;
  }
  for (int k = 0; k < 2; k++) {
    if (factor[k] > 0 && factor[k] < HUGE_VAL && at[k] > 0) {
      const double critical = 360 * round((m->shown[k] - 180) / 360) + 180, dB = 20 * log10(factor[k]);
      mark[n] = (margin_mark){"", 5 + 2 * k, at[k], -dB, critical, critical, -1 / factor[k], 0};
      snprintf(mark[n++].text, sizeof mark->text, "gain %s %.3g dB at %.4g rad/s", k ? "reduction" : "margin", dB,
               at[k]);
    }
  }
  if (m->delay < HUGE_VAL) {
    const double critical = 360 * round((m->shown[2] - 180) / 360) + 180, degrees = m->phase * 180 / function_pi,
                 side = m->shown[2] < critical ? -1 : 1;
    mark[n] = (margin_mark){
        "", 9, m->phase_at, 0, critical, critical + side * degrees, -cos(m->phase), -side * sin(m->phase)};
    snprintf(mark[n++].text, sizeof mark->text, "phase margin %.3g deg at %.4g rad/s", degrees, m->phase_at);
  }
  return n;
}

/* What of a mark a panel shows: 0 gain, 1 phase, 2 Nyquist. */
static void draw_mark(FILE *gnuplot, const margin_mark *mark, int color, int panel)
{
  const double x = panel == 2 ? mark->re : mark->omega;
  const double y[3] = {mark->dB, mark->phase, mark->im}, from[2] = {0, mark->critical};
  fprintf(gnuplot, "set label '' at %.9g,%.9g point pointtype %d pointsize 0.8 linetype %d front\n", x, y[panel],
          mark->symbol, color);
  if (panel < 2) {
    fprintf(gnuplot, "set arrow from %.9g,%.9g to %.9g,%.9g nohead linetype %d linewidth 2 front\n", x, from[panel], x,
            y[panel], color);
    fprintf(gnuplot, "set arrow from graph 0, first %.9g to graph 1, first %.9g nohead linetype -1 linewidth 0.5\n",
            from[panel], from[panel]);
  }
}

/* A panel of the loops' responses: a curve for each with its margins, which the key of the gain names. */
static void draw_loops(FILE *gnuplot, const scene *s, const char *csv, int panel, const char *columns)
{
  margin_mark mark[3];
  char name[TEXT_NAME + 16];
  fputs("unset arrow\nunset label\n", gnuplot);
  for (int k = 0; k < loops.n_command; k++) {
    for (int i = margin_marks(mark, &loops.margins[k]) - 1; i >= 0; i--) {
      draw_mark(gnuplot, &mark[i], k + 1, panel);
    }
  }
  fputs(panel == 2 ? "set label '' at -1,0 point pointtype 2 linetype -1 linewidth 2\n" : "", gnuplot);
  for (int k = 0; k < loops.n_command; k++) {
    const int n = panel == 0 ? margin_marks(mark, &loops.margins[k]) : 0;
    fputs(k == 0 ? "plot " : ", ", gnuplot);
    put_quoted(gnuplot, csv);
    fprintf(gnuplot, " using (strcol(1) eq '%s' ? %s with lines linetype %d linewidth 1.5 title '%s%s'",
            loop_name(name, s, k), columns, k + 1, name,
            loops.margins[k].radius > 1 + 1e-6 ? ", closed: unstable" : "");
    for (int i = 0; i < n; i++) {
      fprintf(gnuplot, ", NaN with points pointtype %d pointsize 0.8 linetype %d title '%s'", mark[i].symbol, k + 1,
              mark[i].text);
    }
  }
  fputs("\n", gnuplot);
}

/* Bode and Nyquist, the circle of radius 1 and the point -1 in it. */
static void draw_margins(const scene *s, const char *csv)
{
  int longest = 26; /* a margin's is 40 narrow ones */
  char svg[512];
  FILE *gnuplot;
  for (int k = 0; k < loops.n_command; k++) {
    char name[TEXT_NAME + 16];
    longest = (int)fmax(longest, (double)strlen(loop_name(name, s, k)) + 14);
  }
  other_name(svg, sizeof svg, csv, ".svg");
  gnuplot = plot_begin(svg, key_width(longest), 3 * (loops.n_command > 3 ? 100 + 84 * loops.n_command : 430), stdout);
  if (gnuplot) {
    key_place(gnuplot, longest);
    fputs("set multiplot layout 3,1\nset logscale x\nset xlabel 'omega [rad/s]'\nset ylabel 'gain [dB]'\n"
          "set yrange [-120 < *:*]\n",
          gnuplot);
    draw_loops(gnuplot, s, csv, 0, "$2 : NaN):3");
    fputs("set ylabel 'phase [deg]'\nset yrange [*:*]\n", gnuplot);
    draw_loops(gnuplot, s, csv, 1, "$2 : NaN):4");
    fputs("unset logscale x\nset xlabel 're L'\nset ylabel 'im L'\nset size ratio -1\nset xrange [-3:2]\n"
          "set yrange [-2:2]\nset object circle at 0,0 size 1 fillstyle empty border linecolor rgb '#888888'\n",
          gnuplot);
    draw_loops(gnuplot, s, csv, 2, "$5 : NaN):6");
    plot_end(gnuplot, svg, stdout);
  }
}
#endif
