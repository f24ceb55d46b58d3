/* rom.h - writes a fb_body as C: one static const initializer, every number exact (%.17g, single precision %.9g).
   Include flexbeam.h first. */
#ifndef ROM_H
#define ROM_H
#include "config.h"
#include "../common/output.h"
#include <stdio.h>
#include <string.h>

typedef struct rom {
  FILE *out;
  int single, column, depth;
} rom;

static void rom_text(rom *r, const char *text)
{
  const int n = (int)strlen(text);
  if (r->column + n > 116) {
    fputs("\n   ", r->out);
    r->column = 3;
  }
  fprintf(r->out, " %s", text);
  r->column += n + 1;
}

/* A number in the precision of the target, with what makes it one of that type. */
static void rom_real(rom *r, fb_real x)
{
  char text[64];
  snprintf(text, sizeof text - 4, r->single ? "%.9g" : "%.17g", r->single ? (double)(float)x : (double)x);
  if (!strpbrk(text, ".e")) {
    strcat(text, ".0");
  }
  strcat(text, r->single ? "f," : ",");
  rom_text(r, text);
}

static void rom_open(rom *r, const char *member)
{
  fprintf(r->out, "\n  .%s = {", member);
  r->column = 6 + (int)strlen(member);
}

static void rom_reals(rom *r, const char *member, const fb_real *x, int n)
{
  rom_open(r, member);
  for (int i = 0; i < n; i++) {
    rom_real(r, x[i]);
  }
  rom_text(r, n ? "}," : "0},");
}

static void rom_number(rom *r, const char *member, fb_real x)
{
  fprintf(r->out, "\n  .%s =", member);
  r->column = 4 + (int)strlen(member);
  rom_real(r, x);
}

/* Writes a token of the library (fb_token_write): members of the outer struct on lines of their own. */
static void rom_token(void *user, const fb_token *token)
{
  rom *const r = (rom *)user;
  char text[64];
  if (token->name && r->depth == 0) {
    fprintf(r->out, "\n  .%s =", token->name);
    r->column = 4 + (int)strlen(token->name);
  } else if (token->name) {
    snprintf(text, sizeof text, ".%.48s =", token->name);
    rom_text(r, text);
  }
  switch (token->kind) {
  case FB_TOKEN_OPEN:
    rom_text(r, "{");
    r->depth++;
    break;
  case FB_TOKEN_CLOSE:
    rom_text(r, "},");
    r->depth--;
    break;
  case FB_TOKEN_WHOLE:
    snprintf(text, sizeof text, token->type ? "(%.32s)%d," : "%.0s%d,", token->type ? token->type : "", token->whole);
    rom_text(r, text);
    break;
  case FB_TOKEN_REAL:
  case FB_TOKEN_COUNT:
    rom_real(r, token->real);
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
  rom_capacity(r, "FB_MAX_RUNS", body->n_run, 1);
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

/* The body as `static const fb_body NAME`, in double or single precision; source: what it was made from. Bodies with
   nonlinear strain are not written. */
static void rom_write(FILE *out, const fb_body *body, const char *name, const char *source, int single)
{
  rom r = {out, single, 0, 0};
  fprintf(out, "/* %s - made by reduce from ", name);
  output_source(out, source);
  fprintf(out, " for flexbeam %s; include flexbeam.h first. C99, or C++20.\n", FB_VERSION);
  rom_capacities(&r, body);
  fprintf(out, "static const fb_body %s = {", name);
  (void)fb_body_to_tokens(body, rom_token, &r);
  fprintf(out, "\n};\n#define %s_crc 0x%08Xu /* fb_body_crc(&%s): compare it before the model is used */\n", name,
          single ? fb_body_crc_single(body) : fb_body_crc(body), name);
}

/* A shape, of which `body` was made, as a member of that name in an initializer: what fb_body_init needs. */
static inline void rom_shape(FILE *out, const char *member, const fb_shape *s, const fb_body *body, int single)
{
  rom r = {out, single, 0, 0};
  rom_open(&r, member);
  (void)fb_shape_to_tokens(s, body, rom_token, &r);
  fputs("\n  },", out);
}

/* What the description of a body that has no rotors says beside its shape. */
static inline void rom_desc(FILE *out, const char *member, const fb_body_desc *d, int n, int single)
{
  rom r = {out, single, 0, 0};
  fprintf(out, "\n  .%s = {\n  .effects = %uu, .base = (fb_base)%d,", member, d->effects, (int)d->base);
  rom_reals(&r, "zeta", d->zeta, n);
  rom_reals(&r, "gravity", d->gravity, 3);
  rom_number(&r, "mu", d->mu);
  rom_reals(&r, "center", d->center, 3);
  rom_number(&r, "deflection_limit", d->deflection_limit);
  fputs("\n  },", out);
}
#endif
