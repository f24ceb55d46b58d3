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
  int single, column;
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

static void rom_whole(rom *r, int x)
{
  char text[32];
  snprintf(text, sizeof text, "%d,", x);
  rom_text(r, text);
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

static void rom_close(rom *r)
{
  rom_text(r, "},");
}

static void rom_reals(rom *r, const char *member, const fb_real *x, int n)
{
  rom_open(r, member);
  for (int i = 0; i < n; i++) {
    rom_real(r, x[i]);
  }
  if (n == 0) {
    rom_text(r, "0");
  }
  rom_close(r);
}

static void rom_number(rom *r, const char *member, fb_real x)
{
  fprintf(r->out, "\n  .%s =", member);
  r->column = 4 + (int)strlen(member);
  rom_real(r, x);
}

static void rom_sparse(rom *r, const char *member, const fb_sparse *m, int n)
{
  rom_open(r, member);
  rom_whole(r, m->n_term);
  rom_text(r, "{");
  for (int i = 0; i < n; i++) {
    rom_real(r, m->diagonal[i]);
  }
  rom_text(r, n ? "}," : "0},");
  rom_text(r, "{");
  for (int i = 0; i < m->n_term; i++) {
    rom_text(r, "{");
    rom_real(r, m->term[i].c);
    rom_whole(r, m->term[i].a);
    rom_whole(r, m->term[i].b);
    rom_text(r, "},");
  }
  rom_text(r, m->n_term ? "}" : "{0}}");
  rom_close(r);
}

static void rom_terms(rom *r, const fb_body *body)
{
  rom_open(r, "lambda_row");
  for (int i = 0; i < 6; i++) {
    rom_text(r, "{");
    rom_whole(r, body->lambda_row[i].i);
    rom_whole(r, body->lambda_row[i].end);
    rom_text(r, "},");
  }
  rom_close(r);
  rom_open(r, "lambda");
  for (int i = 0; i < body->n_lambda; i++) {
    rom_text(r, "{");
    rom_real(r, body->lambda[i].c);
    rom_whole(r, body->lambda[i].i);
    rom_whole(r, body->lambda[i].a);
    rom_whole(r, body->lambda[i].b);
    rom_text(r, "},");
  }
  rom_text(r, body->n_lambda ? "" : "{0}");
  rom_close(r);
  rom_reals(r, "S", body->S, body->n_S);
  rom_open(r, "run");
  for (int i = 0; i < body->n_run; i++) {
    rom_text(r, "{");
    rom_whole(r, body->run[i].i);
    rom_whole(r, body->run[i].pair);
    rom_whole(r, body->run[i].n);
    rom_text(r, "},");
  }
  rom_text(r, body->n_run ? "" : "{0}");
  rom_close(r);
  rom_open(r, "pair");
  for (int i = 0; i < body->n_pair; i++) {
    rom_text(r, "{");
    rom_whole(r, body->pair[i].a);
    rom_whole(r, body->pair[i].b);
    rom_text(r, "},");
  }
  rom_text(r, body->n_pair ? "" : "{0}");
  rom_close(r);
}

static void rom_list(rom *r, const fb_real *x, int n)
{
  rom_text(r, "{");
  for (int i = 0; i < n; i++) {
    rom_real(r, x[i]);
  }
  rom_text(r, n ? "}," : "0},");
}

#if FB_WITH_LARGE_DEFLECTION
/* A node's place on its line; node 0 and others that are on none: zero. */
static void rom_line_node(rom *r, const fb_lines *lines, const fb_line_node *node)
{
  if (node->line == 0) {
    rom_text(r, "{0},");
    return;
  }
  rom_text(r, "{");
  rom_whole(r, node->line);
  rom_whole(r, node->after);
  rom_list(r, node->start, 3);
  rom_list(r, node->weight, lines->line[node->line - 1].count);
  rom_list(r, node->turn, 3 * lines->line[node->line - 1].n);
  rom_list(r, node->bow, 3 * lines->line[node->line - 1].n);
  rom_real(r, node->x);
  rom_list(r, node->axes, 9);
  rom_text(r, "},");
}

static void rom_line(rom *r, const fb_line *line)
{
  const int whole[] = {line->first,   line->n,         line->point,  line->count, line->stride, line->row,
                       line->n_turn,  line->n_stretch, line->weight, line->shift, line->moves,  line->hangs,
                       line->carries, line->solid,     line->plane,  line->turned};
  rom_text(r, "{");
  for (int i = 0; i < (int)(sizeof whole / sizeof *whole); i++) {
    rom_whole(r, whole[i]);
  }
  rom_list(r, line->axes, 9);
  rom_list(r, line->root, 3);
  rom_text(r, "{0},},"); /* the frame is for model building */
}

/* Where n points or roots stand. */
static void rom_stations(rom *r, const char *member, const fb_line_station *s, int n)
{
  rom_open(r, member);
  for (int k = 0; k < n; k++) {
    rom_text(r, "{");
    rom_real(r, s[k].x);
    rom_real(r, s[k].length);
    rom_real(r, s[k].before);
    rom_list(r, s[k].axes, 9);
    rom_whole(r, s[k].side);
    rom_text(r, "},");
  }
  rom_text(r, n ? "" : "{0}");
  rom_close(r);
}

/* Before and behind, n numbers each. */
static void rom_two_rows(rom *r, const fb_real *x, int n)
{
  rom_text(r, "{");
  rom_list(r, x, n);
  rom_list(r, x + n, n);
  rom_text(r, "},");
}

static void rom_sides(rom *r, const fb_lines *all)
{
  rom_open(r, "side");
  for (int k = 0; k < all->n_side; k++) {
    rom_text(r, "{");
    rom_list(r, all->side[k].mass, 2);
    rom_two_rows(r, all->side[k].first[0], 3);
    rom_two_rows(r, all->side[k].moment[0], 6);
    rom_text(r, "},");
  }
  rom_text(r, all->n_side ? "" : "{0}");
  rom_close(r);
}

/* Points of three axes. */
static void rom_axes(rom *r, const char *member, const fb_real x[3][FB_MAX_POINTS], int n)
{
  rom_open(r, member);
  for (int i = 0; i < 3; i++) {
    rom_list(r, x[i], n);
  }
  rom_close(r);
}

static void rom_lines(rom *r, const fb_lines *all)
{
  fprintf(r->out, "\n  .lines = {\n  .n_line = %d, .n_point = %d, .n_row = %d, .n_table = %d, .n_side = %d,",
          all->n_line, all->n_point, all->n_row, all->n_table, all->n_side);
  rom_open(r, "line");
  for (int l = 0; l < all->n_line; l++) {
    rom_line(r, &all->line[l]);
  }
  rom_text(r, all->n_line ? "" : "{0}");
  rom_close(r);
  rom_reals(r, "mass", all->mass, all->n_point);
  rom_reals(r, "center", all->center, 3 * all->n_point);
  rom_reals(r, "inertia", all->inertia, 6 * all->n_point);
  rom_axes(r, "start", all->start, all->n_point);
  rom_axes(r, "tangent", all->tangent, all->n_point);
  rom_stations(r, "station", all->station, all->n_point);
  rom_stations(r, "root", all->root, all->n_line);
  rom_sides(r, all);
  rom_open(r, "row");
  for (int k = 0; k < all->n_row; k++) {
    rom_text(r, "{");
    rom_whole(r, all->row[k].axis);
    rom_whole(r, all->row[k].a);
    rom_whole(r, all->row[k].at);
    rom_text(r, "},");
  }
  rom_text(r, all->n_row ? "" : "{0}");
  rom_close(r);
  rom_reals(r, "table", all->table, all->n_table);
  rom_close(r);
}
#endif

/* list: of the body or of its shape */
static void rom_nodes(rom *r, const fb_body *body, const fb_node *list)
{
  rom_open(r, "node");
  for (int k = 0; k < body->n_node; k++) {
    const fb_node *node = &list[k];
    rom_text(r, "{");
    rom_list(r, node->r, 3);
    rom_list(r, node->psi, 3 * body->n);
    rom_list(r, node->theta, 3 * body->n);
#if FBI_WITH_QUADRATIC
    if (body->effects & (FB_EFFECT_SPIN_STIFFENING | FB_EFFECT_ACCELERATION_STIFFENING)) { /* else nobody looks */
      rom_list(r, node->chi, 3 * body->n * (body->n + 1) / 2);
      rom_list(r, node->chi_theta, 3 * body->n * (body->n + 1) / 2);
    }
#endif
#if FB_WITH_LARGE_DEFLECTION
    if (body->effects & FB_EFFECT_LARGE_DEFLECTION) {
      rom_line_node(r, &body->lines, &node->line);
    }
#endif
    rom_text(r, "},");
  }
  rom_close(r);
}

#if FB_WITH_ROTORS
static void rom_rotors(rom *r, const fb_body *body)
{
  if (body->n_rotor == 0) {
    return;
  }
  fprintf(r->out, "\n  .n_rotor = %d,", body->n_rotor);
  rom_open(r, "rotor");
  for (int k = 0; k < body->n_rotor; k++) {
    const fb_rotor *rotor = &body->rotor[k];
    rom_text(r, "{");
    rom_whole(r, rotor->node);
    rom_whole(r, rotor->given);
    rom_list(r, rotor->axis, 3);
    rom_real(r, rotor->inertia);
    rom_real(r, rotor->damping);
    rom_real(r, rotor->friction);
    rom_real(r, rotor->friction_speed);
    rom_real(r, rotor->static_imbalance);
    rom_real(r, rotor->dynamic_imbalance);
    rom_real(r, rotor->dynamic_phase);
    rom_whole(r, rotor->moves);
    rom_list(r, rotor->across, 3);
    rom_real(r, rotor->mobility);
    rom_real(r, rotor->rate);
    rom_text(r, "},");
  }
  rom_close(r);
}
#endif

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
  rom r = {out, single, 0};
  fprintf(out, "/* %s - made by reduce from ", name);
  output_source(out, source);
  fprintf(out, " for flexbeam %s; include flexbeam.h first. C99, or C++20.\n", FB_VERSION);
  rom_capacities(&r, body);
  fprintf(
      out,
      "static const fb_body %s = {\n  .n = %d, .n_node = %d, .n_coordinate = %d, .effects = %uu, .base = (fb_base)%d,\n"
      "  .unit_mass = %d, .constant_S = %d, .allow_long_step = %d,\n"
      "  .n_lambda = %d, .n_lambda_constant = %d, .n_linear_constant = %d, .n_linear = %d, .n_row = %d,\n"
      "  .n_S = %d, .n_run = %d, .n_pair = %d,",
      name, body->n, body->n_node, body->n_coordinate, body->effects, (int)body->base, body->unit_mass,
      body->constant_S, body->allow_long_step, body->n_lambda, body->n_lambda_constant, body->n_linear_constant,
      body->n_linear, body->n_row, body->n_S, body->n_run, body->n_pair);
  rom_number(&r, "mass", body->mass);
  rom_reals(&r, "c", body->c, 3);
  rom_number(&r, "deflection_limit", body->deflection_limit);
  rom_reals(&r, "reach", body->reach, body->n);
  rom_number(&r, "recoil", body->recoil);
  rom_number(&r, "gyration", body->gyration);
  rom_number(&r, "limit_elastic", body->limit_elastic);
  rom_number(&r, "limit_damping", body->limit_damping);
  rom_number(&r, "limit_spin", body->limit_spin);
  rom_number(&r, "limit_acceleration", body->limit_acceleration);
#if FB_WITH_LARGE_DEFLECTION
  if (body->effects & FB_EFFECT_LARGE_DEFLECTION) {
    rom_lines(&r, &body->lines);
    rom_sparse(&r, "M_rest", &body->M_rest, body->n);
    rom_reals(&r, "c_rest", body->c_rest, 3);
  }
#endif
  rom_reals(&r, "S0", body->S0, 21);
  rom_reals(&r, "S0_inverse", body->S0_inverse, 36);
  rom_sparse(&r, "M", &body->M, body->n);
  rom_sparse(&r, "Minv", &body->Minv, body->n);
  rom_sparse(&r, "K", &body->K, body->n);
#if FB_WITH_DAMPING
  if (body->effects & FB_EFFECT_DAMPING) {
    rom_sparse(&r, "C", &body->C, body->n);
  }
#endif
#if FB_WITH_GRAVITY
  if (body->effects & FB_EFFECT_GRAVITY) {
    rom_reals(&r, "gravity", body->gravity, 3);
  }
  if (body->effects & FB_EFFECT_CENTRAL_GRAVITY) {
    rom_number(&r, "mu", body->mu);
    rom_reals(&r, "center", body->center, 3);
  }
#endif
#if FB_WITH_ROTORS
  rom_rotors(&r, body);
#endif
  rom_terms(&r, body);
  rom_nodes(&r, body, body->node);
  fprintf(out, "\n};\n#define %s_crc 0x%08Xu /* fb_body_crc(&%s): compare it before the model is used */\n", name,
          fbi_body_crc(body, single), name);
}

static void rom_second(rom *r, const char *member, const fb_second *s, int n)
{
  rom_open(r, member);
  rom_reals(r, "ups", s->ups, 3 * n * n);
  rom_reals(r, "Gam", s->Gam, 9 * n);
  rom_reals(r, "Pi", s->Pi, 9 * n * n);
  rom_reals(r, "Gamchi", s->Gamchi, 9 * n * n);
  rom_reals(r, "pchi", s->pchi, 3 * n * n);
  rom_reals(r, "hchi", s->hchi, 3 * n * n);
  rom_reals(r, "reach", s->reach, n);
  rom_close(r);
}

/* A shape, of which `body` was made, as a member of that name in an initializer: what fb_body_init needs. */
static inline void rom_shape(FILE *out, const char *member, const fb_shape *s, const fb_body *body, int single)
{
  rom r = {out, single, 0};
  fprintf(out, "  .%s = {\n  .n = %d, .n_node = %d,", member, s->n, s->n_node);
  rom_number(&r, "mass", s->mass);
  rom_reals(&r, "c", s->c, 3);
  rom_reals(&r, "J", s->J, 9);
  rom_reals(&r, "P", s->P, 3 * s->n);
  rom_reals(&r, "H", s->H, 3 * s->n);
  rom_reals(&r, "M", s->M, s->n * s->n);
  rom_reals(&r, "K", s->K, s->n * s->n);
  rom_second(&r, "second", &s->second, s->n);
#if FB_WITH_LARGE_DEFLECTION
  if (body->effects & FB_EFFECT_LARGE_DEFLECTION) {
    rom_lines(&r, &s->lines);
    rom_second(&r, "rest", &s->rest, s->n);
  }
#endif
  rom_number(&r, "size", s->size);
  rom_nodes(&r, body, s->node);
  fputs("\n  },", out);
}

/* What the description of a body that has no rotors says beside its shape. */
static inline void rom_desc(FILE *out, const char *member, const fb_body_desc *d, int n, int single)
{
  rom r = {out, single, 0};
  fprintf(out, "\n  .%s = {\n  .effects = %uu, .base = (fb_base)%d,", member, d->effects, (int)d->base);
  rom_reals(&r, "zeta", d->zeta, n);
  rom_reals(&r, "gravity", d->gravity, 3);
  rom_number(&r, "mu", d->mu);
  rom_reals(&r, "center", d->center, 3);
  rom_number(&r, "deflection_limit", d->deflection_limit);
  fputs("\n  },", out);
}
#endif
