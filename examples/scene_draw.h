/* scene_draw.h - pictures of a moving scene as SVG: frames one by one, an animation that any browser plays, or a few
   frames over each other. See scene.h. */
#ifndef SCENE_DRAW_H
#define SCENE_DRAW_H
#include "scene_parts.h"

#define SCENE_FRAMES 480
#define SCENE_POINTS 49 /* of a body's line */

typedef struct scene_line { /* of a body, or a link between bodies */
  int n;
  double x[SCENE_POINTS][3]; /* later: x, y on the page */
} scene_line;

typedef struct scene_frame {
  double t;
  scene_line line[2 * FB_MAX_BODIES]; /* bodies, then what joins them */
} scene_frame;

static struct scene_film {
  int n, n_body;
  scene_frame frame[SCENE_FRAMES];
} film;

static const double scene_page_width = 640, scene_page_height = 480, scene_margin = 24;

static const char *const scene_colors[] = {"#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#17becf"};

/* ---- on the page */

/* The two axes seen: of `view`, or of the largest extent; else aslant. */
static void scene_axes_seen(scene_view_from view, double right[3], double up[3])
{
  double least[3], most[3];
  int flat = 2;
  for (int i = 0; i < 3; i++) {
    least[i] = HUGE_VAL;
    most[i] = -HUGE_VAL;
    right[i] = up[i] = 0;
  }
  for (int k = 0; k < film.n; k++) {
    for (int b = 0; b < film.n_body; b++) {
      for (int p = 0; p < film.frame[k].line[b].n; p++) {
        for (int i = 0; i < 3; i++) {
          least[i] = fmin(least[i], film.frame[k].line[b].x[p][i]);
          most[i] = fmax(most[i], film.frame[k].line[b].x[p][i]);
        }
      }
    }
  }
  for (int i = 1; i >= 0; i--) {
    flat = most[i] - least[i] < most[flat] - least[flat] ? i : flat;
  }
  if (view == SCENE_VIEW_ANY) {
    const double other =
        fmax(most[(flat + 1) % 3] - least[(flat + 1) % 3], most[(flat + 2) % 3] - least[(flat + 2) % 3]);
    view = most[flat] - least[flat] > 0.2 * other ? SCENE_VIEW_ASLANT
           : flat == 2                            ? SCENE_VIEW_TOP
           : flat == 1                            ? SCENE_VIEW_FRONT
                                                  : SCENE_VIEW_SIDE;
  }
  if (view == SCENE_VIEW_ASLANT) {
    right[0] = 0.8;
    right[1] = 0.6;
    up[0] = -0.3;
    up[1] = 0.4;
    up[2] = sqrt(0.75);
  } else {
    right[view == SCENE_VIEW_SIDE ? 1 : 0] = 1;
    up[view == SCENE_VIEW_TOP ? 1 : 2] = 1;
  }
}

/* All points to page coordinates, in scale, centered. */
static void scene_project(scene_view_from view)
{
  double right[3], up[3], least[2] = {HUGE_VAL, HUGE_VAL}, most[2] = {-HUGE_VAL, -HUGE_VAL}, scale;
  scene_axes_seen(view, right, up);
  for (int pass = 0; pass < 2; pass++) {
    scale = pass ? fmin((scene_page_width - 2 * scene_margin) / fmax(most[0] - least[0], 1e-12),
                        (scene_page_height - 2 * scene_margin) / fmax(most[1] - least[1], 1e-12))
                 : 1;
    for (int k = 0; k < film.n; k++) {
      for (int l = 0; l < 2 * film.n_body; l++) {
        for (int p = 0; p < film.frame[k].line[l].n; p++) {
          double *const x = film.frame[k].line[l].x[p];
          if (pass) {
            x[0] = 0.5 * scene_page_width + scale * (x[0] - 0.5 * (least[0] + most[0]));
            x[1] = 0.5 * scene_page_height - scale * (x[1] - 0.5 * (least[1] + most[1]));
            continue;
          }
          const double page[2] = {x[0] * right[0] + x[1] * right[1] + x[2] * right[2],
                                  x[0] * up[0] + x[1] * up[1] + x[2] * up[2]};
          for (int i = 0; i < 2; i++) {
            x[i] = page[i];
            least[i] = fmin(least[i], page[i]);
            most[i] = fmax(most[i], page[i]);
          }
        }
      }
    }
  }
}

/* ---- SVG */

static void scene_svg_begin(FILE *svg, const char *title)
{
  fprintf(svg,
          "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" font-family=\"sans-serif\" "
          "font-size=\"12\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"#ffffff\"/>\n",
          scene_page_width, scene_page_height);
  fprintf(svg, "<text x=\"%.0f\" y=\"16\" fill=\"#555555\">%s</text>\n", scene_margin, title);
}

static void scene_svg_points(FILE *svg, const scene_line *line)
{
  for (int p = 0; p < line->n; p++) {
    fprintf(svg, "%s%.1f,%.1f", p ? " " : "", line->x[p][0], line->x[p][1]);
  }
}

static void scene_svg_style(FILE *svg, int l, double opacity)
{
  const int body = l < film.n_body;
  fprintf(svg,
          "fill=\"none\" stroke=\"%s\" stroke-width=\"%s\" stroke-linecap=\"round\" stroke-linejoin=\"round\" "
          "opacity=\"%.2f\"",
          body ? scene_colors[l % 6] : "#999999", body ? "3" : "1", opacity);
}

/* A frame; links lie below bodies. */
static void scene_svg_frame(FILE *svg, const scene_frame *frame, double opacity)
{
  for (int k = 2 * film.n_body - 1; k >= 0; k--) {
    if (frame->line[k].n > 0) {
      fputs("<polyline points=\"", svg);
      scene_svg_points(svg, &frame->line[k]);
      fputs("\" ", svg);
      scene_svg_style(svg, k, opacity);
      fputs("/>\n", svg);
    }
  }
}

/* Where the ends of the bodies went, up to a frame. */
static void scene_svg_trails(FILE *svg, int upto)
{
  for (int b = 0; b < film.n_body; b++) {
    fputs("<polyline points=\"", svg);
    for (int k = 0; k <= upto && film.frame[k].line[b].n > 0; k++) {
      const scene_line *const line = &film.frame[k].line[b];
      fprintf(svg, "%s%.1f,%.1f", k ? " " : "", line->x[line->n - 1][0], line->x[line->n - 1][1]);
    }
    fprintf(svg, "\" fill=\"none\" stroke=\"%s\" stroke-width=\"0.7\" opacity=\"0.35\"/>\n", scene_colors[b % 6]);
  }
}

/* Every line changes through all frames; a bar shows the time. */
static void scene_svg_animate(FILE *svg, double duration)
{
  const double shown = duration > 0 ? fmin(fmax(duration, 4), 20) : 4; /* [s] it plays */
  const double width = scene_page_width - 2 * scene_margin, y = scene_page_height - 8;
  for (int l = 2 * film.n_body - 1; l >= 0; l--) {
    if (film.frame[0].line[l].n == 0) {
      continue;
    }
    fputs("<polyline ", svg);
    scene_svg_style(svg, l, 1);
    fputs("><animate attributeName=\"points\" repeatCount=\"indefinite\" ", svg);
    fprintf(svg, "dur=\"%.3gs\" values=\"", shown);
    for (int k = 0; k < film.n; k++) {
      fputs(k ? ";" : "", svg);
      scene_svg_points(svg, &film.frame[k].line[l]);
    }
    fputs("\"/></polyline>\n", svg);
  }
  fprintf(svg,
          "<rect x=\"%.0f\" y=\"%.0f\" height=\"3\" width=\"%.0f\" fill=\"#bbbbbb\"><animate attributeName=\"width\" "
          "repeatCount=\"indefinite\" dur=\"%.3gs\" values=\"0;%.0f\"/></rect>\n"
          "<text x=\"%.0f\" y=\"%.0f\" fill=\"#555555\" text-anchor=\"end\">%.4g s</text>\n",
          scene_margin, y, width, shown, width, scene_page_width - scene_margin, y - 4, duration);
}

/* ---- files */

static FILE *scene_svg_open(scene *s, const char *name, const char *title)
{
  FILE *const svg = fopen(name, "w");
  if (!svg) {
    scene_fail(s, "cannot write %s: %s", name, strerror(errno));
    return NULL;
  }
  scene_svg_begin(svg, title);
  return svg;
}

static int scene_svg_close(scene *s, FILE *svg, const char *name)
{
  fputs("</svg>\n", svg);
  return fclose(svg) == 0 ? 0 : scene_fail(s, "cannot write %s", name);
}

static void scene_frame_name(char *name, size_t size, const char *folder, int k)
{
  snprintf(name, size, "%.480s/frame_%04d.svg", folder, k + 1);
}

static int scene_write_frame(scene *s, const char *folder, int k)
{
  char name[512], title[64];
  FILE *svg;
  scene_frame_name(name, sizeof name, folder, k);
  snprintf(title, sizeof title, "t = %.4g s", film.frame[k].t);
  svg = scene_svg_open(s, name, title);
  if (!svg) {
    return 1;
  }
  scene_svg_trails(svg, k);
  scene_svg_frame(svg, &film.frame[k], 1);
  return scene_svg_close(s, svg, name);
}

static int scene_write_animation(scene *s, const char *name)
{
  FILE *const svg = scene_svg_open(s, name, s->title);
  if (!svg) {
    return 1;
  }
  scene_svg_trails(svg, film.n - 1);
  scene_svg_animate(svg, s->duration);
  return scene_svg_close(s, svg, name);
}

/* Nine frames over each other, the last ones strongest. */
static int scene_write_picture(scene *s, const char *name)
{
  const int shown = film.n < 9 ? film.n : 9;
  FILE *const svg = scene_svg_open(s, name, s->title);
  if (!svg) {
    return 1;
  }
  scene_svg_trails(svg, film.n - 1);
  for (int k = 0; k < shown; k++) {
    scene_svg_frame(svg, &film.frame[shown > 1 ? k * (film.n - 1) / (shown - 1) : 0], 0.15 + 0.85 * (k + 1) / shown);
  }
  return scene_svg_close(s, svg, name);
}
#endif
