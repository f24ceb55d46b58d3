/* fmu_icon.h - the icon of an FMU, a hub with two beams that bend, as SVG and as PNG with a transparent ground: both from
   the same lines. */
#ifndef FMU_ICON_H
#define FMU_ICON_H
#include "fmu_xml.h"
#include <math.h>
#include <stdio.h>

enum { ICON = 128, ICON_POINTS = 17, ICON_LINES = 3 }; /* pixels of a side */

typedef struct icon_line {
  double width;
  int n;
  double x[ICON_POINTS][2];
} icon_line;

/* A beam is a parabola from the middle to either side; the hub a short thick line. */
static void icon_lines(icon_line line[ICON_LINES])
{
  const icon_line hub = {34, 2, {{56, 80}, {72, 80}}};
  for (int side = 0; side < 2; side++) {
    line[side].width = 7;
    line[side].n = ICON_POINTS;
    for (int k = 0; k < ICON_POINTS; k++) {
      const double s = (double)k / (ICON_POINTS - 1);
      line[side].x[k][0] = 64 + (side ? 56 : -56) * s;
      line[side].x[k][1] = 80 - 44 * s * s;
    }
  }
  line[2] = hub;
}

static void icon_write_svg(FILE *out, const fmu_export *e)
{
  icon_line line[ICON_LINES];
  (void)e;
  icon_lines(line);
  fprintf(out,
          "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" fill=\"none\" stroke=\"#000\" "
          "stroke-linecap=\"round\" stroke-linejoin=\"round\">\n",
          ICON, ICON);
  for (int k = 0; k < ICON_LINES; k++) {
    fprintf(out, "<polyline stroke-width=\"%g\" points=\"", line[k].width);
    for (int i = 0; i < line[k].n; i++) {
      fprintf(out, "%s%.4g,%.4g", i ? " " : "", line[k].x[i][0], line[k].x[i][1]);
    }
    fputs("\"/>\n", out);
  }
  fputs("</svg>\n", out);
}

/* How much of the pixel around x, y a line covers: 0 to 1. */
static double icon_cover(const icon_line *line, double x, double y)
{
  double nearest = HUGE_VAL;
  for (int k = 0; k + 1 < line->n; k++) {
    const double *const a = line->x[k], *const b = line->x[k + 1];
    const double dx = b[0] - a[0], dy = b[1] - a[1];
    const double s = fmax(0, fmin(1, ((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy)));
    nearest = fmin(nearest, hypot(a[0] + s * dx - x, a[1] + s * dy - y));
  }
  return fmax(0, fmin(1, 0.5 * line->width - nearest + 0.5));
}

/* Big-endian, as PNG and zlib have numbers. */
static size_t icon_put(unsigned char *to, unsigned x)
{
  for (int k = 0; k < 4; k++) {
    to[k] = (unsigned char)(x >> (24 - 8 * k));
  }
  return 4;
}

static void icon_write_chunk(FILE *out, const char *kind, const unsigned char *data, size_t n)
{
  unsigned char head[8], tail[4];
  unsigned crc = ~0u;
  icon_put(head, (unsigned)n);
  memcpy(head + 4, kind, 4);
  for (size_t k = 0; k < n + 4; k++) {
    crc ^= k < 4 ? head[4 + k] : data[k - 4];
    for (int bit = 0; bit < 8; bit++) {
      crc = crc & 1 ? crc >> 1 ^ 0xEDB88320u : crc >> 1;
    }
  }
  icon_put(tail, ~crc);
  fwrite(head, 1, sizeof head, out);
  fwrite(data, 1, n, out);
  fwrite(tail, 1, sizeof tail, out);
}

/* Gray and alpha of 8 bits; zlib with one block that is not compressed. */
static void icon_write_png(FILE *out, const fmu_export *e)
{
  enum { ROW = 1 + 2 * ICON, ALL = ROW * ICON };
  static const unsigned char start[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  static const unsigned char zlib[] = {0x78, 0x01, 1, ALL & 255, ALL >> 8, 255 - (ALL & 255), 255 - (ALL >> 8)};
  static unsigned char data[sizeof zlib + ALL + 4];
  unsigned char head[13] = {0, 0, 0, 0, 0, 0, 0, 0, 8, 4, 0, 0, 0}, *const pixel = data + sizeof zlib;
  unsigned a = 1, b = 0;
  icon_line line[ICON_LINES];
  (void)e;
  icon_lines(line);
  memset(data, 0, sizeof data);
  memcpy(data, zlib, sizeof zlib);
  for (int k = 0; k < ICON * ICON; k++) {
    double cover = 0;
    for (int i = 0; i < ICON_LINES; i++) {
      cover = fmax(cover, icon_cover(&line[i], k % ICON + 0.5, k / ICON + 0.5));
    }
    pixel[k / ICON * ROW + 2 + k % ICON * 2] = (unsigned char)(255 * cover + 0.5);
  }
  for (int k = 0; k < ALL; k++) {
    a = (a + pixel[k]) % 65521;
    b = (b + a) % 65521;
  }
  icon_put(pixel + ALL, b << 16 | a);
  icon_put(head, ICON);
  icon_put(head + 4, ICON);
  fwrite(start, 1, sizeof start, out);
  icon_write_chunk(out, "IHDR", head, sizeof head);
  icon_write_chunk(out, "IDAT", data, sizeof data);
  icon_write_chunk(out, "IEND", data, 0);
}
#endif
