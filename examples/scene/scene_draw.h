/* scene_draw.h - pictures of a moving scene as SVG: frames one by one, an animation that any browser plays, or a few
   frames over each other. See scene.h. */
#ifndef SCENE_DRAW_H
#define SCENE_DRAW_H
#include "../common/output.h"
#include "scene_parts.h"

#define SCENE_FRAMES 480
#define SCENE_POINTS 49 /* of a body's line */
#define SCENE_MARKS 16  /* of what is held by the ground; further ones are not drawn */
#define SCENE_LINES (2 * FB_MAX_BODIES + FB_MAX_SPRINGS + SCENE_MARKS)

/* Of a body, a link between bodies, or what the ground holds: its place, and behind it, where it is clamped, another
   place of what is. */
typedef struct scene_line {
  int n;
  double x[SCENE_POINTS][3]; /* later: x, y on the page */
} scene_line;

typedef struct scene_frame {
  double t;
  scene_line line[SCENE_LINES]; /* bodies, what joins them, springs, marks of the ground */
} scene_frame;

static struct scene_film {
  int n, n_body, n_part, n_line; /* n_part: lines before the marks of the ground */
  double scale;                  /* of the page per length, 0: nothing has a size */
  scene_frame frame[SCENE_FRAMES];
} film;

static const double scene_page_width = 640, scene_page_height = 480, scene_margin = 28;
static const double scene_foot = 24; /* below what is drawn: the scale */

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

/* All points to coordinates of the page, and the box that they fill. */
static void scene_flatten(scene_view_from view, double least[2], double most[2])
{
  double right[3], up[3];
  scene_axes_seen(view, right, up);
  for (int i = 0; i < 2; i++) {
    least[i] = HUGE_VAL;
    most[i] = -HUGE_VAL;
  }
  for (int k = 0; k < film.n; k++) {
    for (int l = 0; l < film.n_line; l++) {
      for (int p = 0; p < film.frame[k].line[l].n; p++) {
        double *const x = film.frame[k].line[l].x[p];
        const double page[2] = {x[0] * right[0] + x[1] * right[1] + x[2] * right[2],
                                -(x[0] * up[0] + x[1] * up[1] + x[2] * up[2])};
        for (int i = 0; i < 2; i++) {
          x[i] = page[i];
          least[i] = fmin(least[i], page[i]);
          most[i] = fmax(most[i], page[i]);
        }
      }
    }
  }
}

static void scene_add_page_point(scene_line *line, double x, double y)
{
  line->x[line->n][0] = x;
  line->x[line->n++][1] = y;
}

/* Hatches along (x, y) + (-12 .. 12) (ax, ay), on the side of (bx, by). */
static void scene_hatch(scene_line *line, double x, double y, double ax, double ay, double bx, double by)
{
  for (int k = -2; k <= 2; k++) {
    const double px = x + 6 * k * ax, py = y + 6 * k * ay;
    scene_add_page_point(line, px, py);
    scene_add_page_point(line, px + 6 * bx - 5 * ax, py + 6 * by - 5 * ay);
    scene_add_page_point(line, px, py);
  }
}

/* The sign of the ground in place of what it holds: a wall across what is clamped, else a support below. */
static void scene_draw_ground(scene_line *line)
{
  const double x = line->x[0][0], y = line->x[0][1];
  const double dx = line->n > 1 ? line->x[1][0] - x : 0, dy = line->n > 1 ? line->x[1][1] - y : 0, d = hypot(dx, dy);
  line->n = 0;
  for (int k = 0; k < 5 && d > 0.1; k++) {
    scene_add_page_point(line, x,
                         y); /* as many as below: what turns while it is seen may change from one to the other */
  }
  if (d > 0.1) {
    scene_hatch(line, x, y, -dy / d, dx / d, -dx / d, -dy / d);
    return;
  }
  scene_add_page_point(line, x, y);
  scene_add_page_point(line, x - 8, y + 13);
  scene_add_page_point(line, x + 8, y + 13);
  scene_add_page_point(line, x, y);
  scene_add_page_point(line, x - 8, y + 13);
  scene_hatch(line, x, y + 13, 1, 0, 0, 1);
}

/* All points to the page, in scale, centered; marks to their signs. */
static void scene_project(scene_view_from view)
{
  const double width = scene_page_width - 2 * scene_margin, height = scene_page_height - 2 * scene_margin - scene_foot;
  double least[2], most[2], scale;
  scene_flatten(view, least, most);
  film.scale = most[0] - least[0] > 0 || most[1] - least[1] > 0
                   ? fmin(width / fmax(most[0] - least[0], 1e-12), height / fmax(most[1] - least[1], 1e-12))
                   : 0;
  scale = film.scale;
  for (int k = 0; k < film.n; k++) {
    for (int l = 0; l < film.n_line; l++) {
      scene_line *const line = &film.frame[k].line[l];
      for (int p = 0; p < line->n; p++) {
        line->x[p][0] = scene_margin + 0.5 * width + scale * (line->x[p][0] - 0.5 * (least[0] + most[0]));
        line->x[p][1] = scene_margin + 0.5 * height + scale * (line->x[p][1] - 0.5 * (least[1] + most[1]));
      }
      if (l >= film.n_part && line->n > 0) {
        scene_draw_ground(line);
      }
    }
  }
}

/* ---- SVG */

/* A bar of 1, 2 or 5 times a power of ten, with its length. */
static void scene_svg_scale(FILE *svg, const char *unit)
{
  const double y = scene_page_height - 20, most = 150 / film.scale, ten = pow(10, floor(log10(most)));
  const double length = ten * (most >= 5 * ten ? 5 : most >= 2 * ten ? 2 : 1), end = scene_margin + film.scale * length;
  if (!(film.scale > 0)) {
    return;
  }
  fprintf(svg,
          "<path d=\"M%.1f,%.1fv8m0,-4H%.1fm0,-4v8\" fill=\"none\" stroke=\"#555555\"/>\n"
          "<text x=\"%.1f\" y=\"%.1f\" fill=\"#555555\">%g %s</text>\n",
          scene_margin, y - 4, end, end + 6, y + 4, length, unit);
}

static void scene_svg_begin(FILE *svg, const char *title, const char *unit)
{
  fprintf(svg,
          "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" font-family=\"sans-serif\" "
          "font-size=\"12\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"#ffffff\"/>\n",
          scene_page_width, scene_page_height);
  fprintf(svg, "<text x=\"%.0f\" y=\"16\" fill=\"#555555\">%s</text>\n", scene_margin, title);
  scene_svg_scale(svg, unit);
}

static void scene_svg_points(FILE *svg, const scene_line *line)
{
  for (int p = 0; p < line->n; p++) {
    fprintf(svg, "%s%.1f,%.1f", p ? " " : "", line->x[p][0], line->x[p][1]);
  }
}

static void scene_svg_style(FILE *svg, int l, double opacity)
{
  const int body = l < film.n_body, ground = l >= film.n_part, spring = l >= 2 * film.n_body && !ground;
  fprintf(svg,
          "fill=\"none\" stroke=\"%s\" stroke-width=\"%s\" stroke-linecap=\"round\" stroke-linejoin=\"round\" "
          "opacity=\"%.2f\"",
          body     ? scene_colors[l % 6]
          : ground ? "#333333"
                   : "#999999",
          body ? "3" : "1", opacity);
  fputs(spring ? " stroke-dasharray=\"5 3\"" : "", svg);
}

/* n lines of a frame: marks of the ground and links lie below bodies. */
static void scene_svg_frame(FILE *svg, const scene_frame *frame, int n, double opacity)
{
  for (int k = n - 1; k >= 0; k--) {
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

/* Is a line the same in every frame? */
static int scene_is_still(int l)
{
  const scene_line *const first = &film.frame[0].line[l];
  for (int k = 1; k < film.n; k++) {
    if (memcmp(film.frame[k].line[l].x, first->x, (size_t)first->n * sizeof first->x[0]) != 0) {
      return 0;
    }
  }
  return 1;
}

/* Lines change through all frames; a bar shows the time. */
static void scene_svg_animate(FILE *svg, double duration)
{
  const double shown = duration > 0 ? fmin(fmax(duration, 4), 20) : 4; /* [s] it plays */
  const double width = scene_page_width - 2 * scene_margin, y = scene_page_height - 8;
  for (int l = film.n_line - 1; l >= 0; l--) {
    if (film.frame[0].line[l].n == 0) {
      continue;
    }
    fputs("<polyline points=\"", svg); /* for programs that show what does not move */
    scene_svg_points(svg, &film.frame[0].line[l]);
    fputs("\" ", svg);
    scene_svg_style(svg, l, 1);
    if (scene_is_still(l)) {
      fputs("/>\n", svg);
      continue;
    }
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
  FILE *const svg = output_open(name);
  if (!svg) {
    scene_fail(s, "cannot write %s: %s", name, output_why());
    return NULL;
  }
  scene_svg_begin(svg, title, s->length_unit);
  return svg;
}

static int scene_svg_close(scene *s, FILE *svg, const char *name)
{
  fputs("</svg>\n", svg);
  return output_is_whole(svg, name) ? 0
                                    : scene_fail(s, "cannot write %s: %s%s", name, strerror(errno), output_left(name));
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
  scene_svg_frame(svg, &film.frame[k], film.n_line, 1);
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

/* Nine frames over each other, the last ones strongest, and the ground as it is seen in the last. */
static int scene_write_picture(scene *s, const char *name)
{
  const int shown = film.n < 9 ? film.n : 9;
  FILE *const svg = scene_svg_open(s, name, s->title);
  if (!svg) {
    return 1;
  }
  scene_svg_trails(svg, film.n - 1);
  for (int k = 1; k <= shown; k++) {
    const int at = shown > 1 ? (k - 1) * (film.n - 1) / (shown - 1) : 0;
    scene_svg_frame(svg, &film.frame[at], k < shown ? film.n_part : film.n_line, 0.15 + 0.85 * k / shown);
  }
  return scene_svg_close(s, svg, name);
}
#endif
