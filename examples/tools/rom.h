/* rom.h - writes a fb_body as C: one static const initializer, every number exact (%.17g, single precision %.9g).
   Include flexbeam.h first. What walks over a model is in the file that has the implementation, with FBI_WITH_TEXT:
   library.c, where it is an object of its own. */
#ifndef ROM_H
#define ROM_H
#include <stdio.h>
#include <string.h>

typedef struct rom {
  FILE *out;
  int single, column;
  int depth, is_new; /* of lists, in which members have no names; a list has no element yet */
} rom;

static inline void rom_text(rom *r, const char *text)
{
  const int n = (int)strlen(text);
  if (r->column + n > 116) {
    fputs("\n   ", r->out);
    r->column = 3;
  }
  fprintf(r->out, " %s", text);
  r->column += n + 1;
}

/* The name of a member, if any, on a new line, and text behind it */
static inline void rom_name(rom *r, const char *member, const char *text)
{
  if (member) {
    fprintf(r->out, "\n  .%s =", member);
    r->column = 4 + (int)strlen(member);
  }
  if (text[0]) {
    rom_text(r, text);
  }
}

/* A number in the precision of the target, with what makes it one of that type. */
static inline void rom_number(rom *r, const char *member, fb_real x)
{
  char text[64];
  snprintf(text, sizeof text - 4, r->single ? "%.9g" : "%.17g", r->single ? (double)(float)x : (double)x);
  if (!strpbrk(text, ".e")) {
    strcat(text, ".0");
  }
  strcat(text, r->single ? "f," : ",");
  rom_name(r, member, text);
}

static inline void rom_reals(rom *r, const char *member, const fb_real *x, int n)
{
  rom_name(r, member, "{");
  for (int i = 0; i < n; i++) {
    rom_number(r, NULL, x[i]);
  }
  rom_text(r, n ? "}," : "0},");
}

/* The body as `static const fb_body NAME`, in double or single precision; source: what it was made from. Bodies with
   nonlinear strain are not written. */
void rom_write(FILE *out, const fb_body *body, const char *name, const char *source, int single);
/* A shape, of which `body` was made, as a member of that name in an initializer: what fb_body_init needs. */
void rom_shape(FILE *out, const char *member, const fb_shape *s, const fb_body *body, int single);
/* What the description of a body that has no rotors says beside its shape. */
void rom_desc(FILE *out, const char *member, const fb_body_desc *d, int n, int single);

#ifdef FBI_WITH_TEXT
#include "config.h"
#include "../common/output.h"

/* C++ takes no integer for an enumeration. */
static void rom_whole(rom *r, const char *member, int x)
{
  char text[96];
  snprintf(text, sizeof text, "%s%s%s%s%d,", member ? "." : "", member ? member : "", member ? " = " : "",
           member && strcmp(member, "base") == 0 ? "(fb_base)" : "", x);
  rom_text(r, text);
}

/* What a walk over a model meets (FBI_TEXT_..) */
static void rom_member(void *out, int kind, const char *name, const void *x, int n)
{
  rom *const r = (rom *)out;
  const char *const member = r->depth ? NULL : name;
  const int is_empty = r->is_new;
  r->is_new = kind == FBI_TEXT_LIST;
  switch (kind) {
  case FBI_TEXT_INT:
    rom_whole(r, member, *(const int *)x);
    break;
  case FBI_TEXT_REAL:
    rom_number(r, member, *(const fb_real *)x);
    break;
  case FBI_TEXT_REALS:
    rom_reals(r, member, (const fb_real *)x, n);
    break;
  case FBI_TEXT_END:
    rom_text(r, is_empty ? "{0}}," : "},");
    r->depth -= r->depth > 0;
    break;
  default:
    rom_name(r, member, "{");
    r->depth += r->depth > 0 || kind == FBI_TEXT_LIST;
    break;
  }
}

/* An option that must be least at least; or 0, as large as can be, where that is a choice. */
static void rom_capacity(const rom *r, const char *option, int least, int or_zero)
{
  fprintf(r->out, "#if %s < %d", option, least);
  if (or_zero) {
    fprintf(r->out, " && %s > 0", option);
  }
  fprintf(r->out, "\n#error \"this model wants %s of %d at least\"\n#endif\n", option, least);
}

/* What the target's configuration must hold. */
static void rom_capacities(rom *r, const fb_body *body)
{
  fputs("   Smallest configuration: ", r->out);
  config_flags(r->out, body, r->single, "\n  ");
  fprintf(r->out,
          " */\n#ifndef FLEXBEAM_H\n#error \"include flexbeam.h before this model\"\n"
          "#elif FB_SINGLE != %d\n#error \"this model is in %s precision: it wants -DFB_SINGLE=%d\"\n#else\n",
          r->single, r->single ? "single" : "double", r->single);
  rom_capacity(r, "FB_MAX_MODES", body->n, 0);
  rom_capacity(r, "FB_MAX_NODES", body->n_node, 0);
  rom_capacity(r, "FB_MAX_LAMBDA", body->n_lambda, 1);
  rom_capacity(r, "FB_MAX_S", body->n_S, 1);
#if FB_WITH_ROTORS
  if (body->n_rotor > 0) {
    rom_capacity(r, "FB_MAX_ROTORS", body->n_rotor, 0);
  }
#endif
#if FB_WITH_LARGE_DEFLECTION
  if (body->effects & FB_EFFECT_LARGE_DEFLECTION) {
    rom_capacity(r, "FB_MAX_POINTS", body->lines.n_point, 0);
    rom_capacity(r, "FB_MAX_LINES", body->lines.n_line, 0);
    rom_capacity(r, "FB_MAX_LINE_ROWS", body->lines.n_row, 1);
    rom_capacity(r, "FB_MAX_LINE_TABLE", body->lines.n_table, 1);
  }
#endif
  for (int k = 0; k < CONFIG_EFFECTS; k++) {
    if (body->effects & config_effects[k].effect) {
      fprintf(r->out, "#if !FB_WITH_%s\n#error \"this model wants FB_WITH_%s\"\n#endif\n", config_effects[k].name,
              config_effects[k].name);
    }
  }
  fputs("#endif\n", r->out);
}

static fbi_walk rom_walk(rom *r)
{
  fbi_walk w = fbi_walk_start(1, r->single);
  w.text = rom_member;
  w.out = r;
  return w;
}

void rom_write(FILE *out, const fb_body *body, const char *name, const char *source, int single)
{
  rom r = {out, single, 116, 0, 0};
  fbi_walk w = rom_walk(&r);
  fprintf(out, "/* %s - made by reduce from ", name);
  output_source(out, source);
  fprintf(out, " for flexbeam %s; include flexbeam.h first. C99, or C++20.\n", FB_VERSION);
  rom_capacities(&r, body);
  fprintf(out, "static const fb_body %s = {", name);
  fbi_body_walk(&w, body);
  fprintf(out, "\n};\n#define %s_crc 0x%08Xu /* fb_body_crc(&%s): compare it before the model is used */\n", name,
          ~w.crc, name);
}

static void rom_second(fbi_walk *w, const char *member, const fb_second *s, int n)
{
  fbi_walk_show(w, FBI_TEXT_STRUCT, member, NULL, 0);
  FBI_PART(s, ups, 3 * n * n), FBI_PART(s, Gam, 9 * n), FBI_PART(s, Pi, 9 * n * n), FBI_PART(s, Gamchi, 9 * n * n);
  FBI_PART(s, pchi, 3 * n * n), FBI_PART(s, hchi, 3 * n * n), FBI_PART(s, reach, n);
  fbi_walk_show(w, FBI_TEXT_END, NULL, NULL, 0);
}

void rom_shape(FILE *out, const char *member, const fb_shape *s, const fb_body *body, int single)
{
  rom r = {out, single, 116, 0, 0};
  fbi_walk walk = rom_walk(&r), *const w = &walk;
  const int n = s->n;
  fbi_walk_show(w, FBI_TEXT_STRUCT, member, NULL, 0);
  FBI_INT(s, n), FBI_INT(s, n_node), FBI_REAL(s, mass), FBI_ARRAY(s, c), FBI_ARRAY(s, J), FBI_PART(s, P, 3 * n);
  FBI_PART(s, H, 3 * n), FBI_PART(s, M, n * n), FBI_PART(s, K, n * n);
  rom_second(w, "second", &s->second, n);
#if FB_WITH_LARGE_DEFLECTION
  if (body->effects & FB_EFFECT_LARGE_DEFLECTION) {
    fbi_lines_walk(w, &s->lines);
    rom_second(w, "rest", &s->rest, n);
  }
#endif
  FBI_REAL(s, size);
  fbi_nodes_walk(w, body, s->node);
  fbi_walk_show(w, FBI_TEXT_END, NULL, NULL, 0);
}

void rom_desc(FILE *out, const char *member, const fb_body_desc *d, int n, int single)
{
  rom r = {out, single, 116, 0, 0};
  fbi_walk walk = rom_walk(&r), *const w = &walk;
  fbi_walk_show(w, FBI_TEXT_STRUCT, member, NULL, 0);
  FBI_INT(d, effects), FBI_INT(d, base), FBI_PART(d, zeta, n), FBI_ARRAY(d, gravity), FBI_REAL(d, mu);
  FBI_ARRAY(d, center), FBI_REAL(d, deflection_limit);
  fbi_walk_show(w, FBI_TEXT_END, NULL, NULL, 0);
}
#endif
#endif
