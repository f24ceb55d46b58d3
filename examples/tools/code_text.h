/* code_text.h - writes C: sums of products whose constants are folded, and templates. What is zero by structure leaves
   no text; a sum that is a constant or a variable gets no name. code.h uses it. */
#ifndef CODE_TEXT_H
#define CODE_TEXT_H
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CODE_PREFIX = 200, CODE_NAME = 24, CODE_TERMS = 1200, CODE_WIDTH = 116, CODE_LONG_SUM = 6 };

/* Parameters that stay variable, factors of what the description says: bits of code.vary. */
enum {
  CODE_STIFFNESS = 1,
  CODE_DAMPING = 2,
  CODE_MASS = 4, /* of all but the hub */
  CODE_HUB_MASS = 8,
  CODE_HUB_INERTIA = 16,
  CODE_TABLE = 32, /* every number that code_numbers tells: a place of model->k */
  CODE_DAMPED = 7, /* what changes the damping */
  CODE_HUB = 28    /* what changes the hub relative to the rest */
};

typedef struct code {
  FILE *out;
  const char *name; /* prefix of what is written */
  int single, n;    /* precision, modes */
  int large;        /* 1: with lines */
  int indent;
  int vary;
  int lanes;  /* 0: one body; CODE_LANES: types of several, by lanes; CODE_WIDE: their step by vectors (code_lanes.h) */
  int rotors; /* of the one body; of a tree 0, whose bodies have their own */
  int ends;   /* 1: a step is told what acts at its start and end, 0: at its middle, too */
  int central; /* 1: gravity of a center acts on the one body */
  int traced;  /* 1: its functions are written by ../tools/trace */
  int places;  /* numbers of the model that vary, where a trace writes */
} code;

enum { CODE_LANES = 1, CODE_WIDE = 2 };

typedef struct code_value { /* c times the variable; without a name the constant c */
  double c;
  char name[CODE_NAME];
} code_value;

typedef struct code_term { /* c x y; names may be empty */
  double c;
  char x[CODE_NAME], y[CODE_NAME];
} code_term;

typedef struct code_sum {
  double constant, size; /* size: sum of the magnitudes of the constants, which tells zero from round-off */
  int n;
  code_term term[CODE_TERMS];
} code_sum;

/* Type of a real number of one body. */
static const char *code_scalar(const code *w)
{
  return w->single ? "float" : "double";
}

/* Type of a real number in what is written. */
static const char *code_real(const code *w)
{
  static char wide[CODE_PREFIX + 16];
  snprintf(wide, sizeof wide, "%s%s", w->name, w->lanes == CODE_WIDE ? "_wide" : "_lane");
  return w->lanes ? wide : code_scalar(w);
}

static code_value code_constant(double c)
{
  code_value v = {c, ""};
  return v;
}

static const char *code_of_names = ""; /* of the names of variables */

static code_value code_named(const char *prefix, const char *format, va_list list)
{
  code_value v = {1.0, ""};
  const int at = snprintf(v.name, sizeof v.name, "%s", prefix);
  vsnprintf(v.name + at, sizeof v.name - (size_t)at, format, list);
  return v;
}

#if defined(__GNUC__)
__attribute__((format(printf, 1, 2)))
#endif
static code_value
code_variable(const char *format, ...)
{
  va_list list;
  code_value v;
  va_start(list, format);
  v = code_named(code_of_names, format, list);
  va_end(list);
  return v;
}

/* One that is the same whatever body or correction is written. */
#if defined(__GNUC__)
__attribute__((format(printf, 1, 2)))
#endif
static inline code_value
code_plain(const char *format, ...)
{
  va_list list;
  code_value v;
  va_start(list, format);
  v = code_named("", format, list);
  va_end(list);
  return v;
}

static int code_is_zero(const code_value *v)
{
  return !(fabs(v->c) > 0.0);
}

static int code_is_constant(const code_value *v)
{
  return v->name[0] == '\0';
}

/* A field of the model where one of these parameters varies, else 1. */
static code_value code_factor_of(const code *w, int parameters, const char *field)
{
  return w->vary & parameters ? code_variable("model->%s", field) : code_constant(1.0);
}

/* The numbers of a text in their order: so that a table of them tells a model from another one of the same form. */
static struct code_numbers {
  int n, most;     /* so far; that have room */
  double *value;   /* where they are noted; NULL: they are written */
  const int *slot; /* place of each in the table, -1: it is a literal */
} code_numbers;

/* Is the next number noted, or a place of the table? Else it is a literal. */
static int code_number_placed(char text[40], double c)
{
  const int at = code_numbers.n++;
  if (code_numbers.value) {
    if (at < code_numbers.most) {
      code_numbers.value[at] = c;
    }
    strcpy(text, "#");
    return 1;
  }
  if (at < code_numbers.most && code_numbers.slot[at] >= 0) {
    snprintf(text, 40, "model->k[%d]", code_numbers.slot[at]);
    return 1;
  }
  return 0;
}

/* c with all its digits, in the precision of the target. */
static void code_number(char text[40], const code *w, double c)
{
  if (w->vary & CODE_TABLE && code_number_placed(text, c)) {
    return;
  }
  snprintf(text, 36, w->single ? "%.9g" : "%.17g", w->single ? (double)(float)c : c);
  if (!strpbrk(text, ".en")) {
    strcat(text, ".0");
  }
  if (w->single) {
    strcat(text, "f");
  }
}

static void code_begin(code_sum *s)
{
  s->constant = s->size = 0.0;
  s->n = 0;
}

/* s += c x y */
static void code_add(code_sum *s, double c, code_value x, code_value y)
{
  const double all = c * x.c * y.c;
  code_term *t = &s->term[s->n];
  if (!(fabs(all) > 0.0)) {
    return;
  }
  if (code_is_constant(&x) && code_is_constant(&y)) {
    s->constant += all;
    s->size += fabs(all);
    return;
  }
  if (s->n == CODE_TERMS) {
    fputs("reduce: --code: a sum of too many terms\n", stderr);
    exit(1);
  }
  t->c = all;
  strcpy(t->x, code_is_constant(&x) ? y.name : x.name);
  strcpy(t->y, code_is_constant(&x) || code_is_constant(&y) ? "" : y.name);
  s->n++;
}

static void code_add_one(code_sum *s, double c, code_value x)
{
  code_add(s, c, x, code_constant(1.0));
}

/* A term with its sign as text; first: at the head of a sum; in: of the second half in brackets, a sum of its own. */
static void code_term_text(char text[120], const code *w, const code_term *t, int first, int in)
{
  char number[40];
  const int unit = !(fabs(fabs(t->c) - 1.0) > 0.0), head = first || in;
  const char *const sign = t->c < 0.0 ? (head ? "-" : " - ") : (head ? "" : " + ");
  code_number(number, w, fabs(t->c));
  snprintf(text, 120, "%s%s%s%s%s%s%s", in ? " + (" : "", sign, unit ? "" : number, unit ? "" : " * ", t->x,
           t->y[0] ? " * " : "", t->y);
}

/* The sum as an expression, which begins at a column of the line. The halves of a long one do not wait for each other. */
static void code_expression(const code *w, const code_sum *s, int column)
{
  char text[120];
  const int half = s->n >= CODE_LONG_SUM ? (s->n + 1) / 2 : 0;
  int first = 1;
  if (fabs(s->constant) > 0.0 || s->n == 0) {
    code_number(text, w, s->constant);
    fputs(text, w->out);
    column += (int)strlen(text);
    first = 0;
  }
  for (int k = 0; k < s->n; k++) {
    code_term_text(text, w, &s->term[k], first, half > 0 && k == half);
    if (column + (int)strlen(text) > CODE_WIDTH) {
      fputs("\n     ", w->out);
      column = 5;
    }
    fputs(text, w->out);
    column += (int)strlen(text);
    first = 0;
  }
  fputs(half > 0 ? ")" : "", w->out);
}

/* Constants whose sum is round-off are zero. */
static void code_settle(code_sum *s)
{
  if (fabs(s->constant) <= 64.0 * DBL_EPSILON * s->size) {
    s->constant = 0.0;
  }
}

/* Is a name that of a table of numbers, which are the same for all lanes, or none? */
static int code_is_table(const char *name)
{
  return name[0] == '\0' || (strstr(name, "][") && !strchr(name, '.') && !strstr(name, "->"));
}

/* Is the sum the same for all lanes? */
static int code_is_common(const code_sum *s)
{
  int common = 1;
  for (int k = 0; k < s->n; k++) {
    common = common && code_is_table(s->term[k].x) && code_is_table(s->term[k].y);
  }
  return common;
}

/* = the sum; */
static void code_equals(const code *w, const code_sum *s, int column)
{
  const int common = w->lanes && code_is_common(s);
  if (common) {
    fprintf(w->out, "%s_wide_all(", w->name);
  }
  code_expression(w, s, column);
  fputs(common ? ");\n" : ";\n", w->out);
}

/* The sum as a value: what it is already called, or a new variable. */
static code_value code_end(const code *w, code_sum *s, code_value name)
{
  code_settle(s);
  if (s->n == 0) {
    return code_constant(s->constant);
  }
  if (s->n == 1 && !(fabs(s->constant) > 0.0) && s->term[0].y[0] == '\0' && !(fabs(fabs(s->term[0].c) - 1.0) > 0.0)) {
    code_value same = {s->term[0].c, ""};
    strcpy(same.name, s->term[0].x);
    return same;
  }
  fprintf(w->out, "%*sconst %s %s = ", w->indent, "", code_real(w), name.name);
  code_equals(w, s, 16 + w->indent + (int)strlen(name.name));
  return name;
}

/* target = the sum; the target is any place. */
static void code_assign(const code *w, code_sum *s, const char *target)
{
  code_settle(s);
  fprintf(w->out, "%*s%s = ", w->indent, "", target);
  code_equals(w, s, w->indent + 4 + (int)strlen(target));
}

/* const name = the sum */
static void code_declare(const code *w, code_sum *s, const char *name)
{
  char target[CODE_PREFIX + 96];
  snprintf(target, sizeof target, "const %s %s", code_real(w), name);
  code_assign(w, s, target);
}

/* What a template's % and a letter mean: sizes and places in the vector of the state (quat u h | q | pi | angles and
   momenta of rotors | rho L). */
static int code_place(const code *w, char letter)
{
  switch (letter) {
  case 'n': /* modes */
    return w->n;
  case 'm': /* modes, at least one */
    return w->n > 0 ? w->n : 1;
  case 'p': /* where pi begins */
    return 10 + w->n;
  case 'R': /* rotors */
    return w->rotors;
  case 'k': /* their angles */
    return 10 + 2 * w->n;
  case 'g': /* their momenta */
    return 10 + 2 * w->n + w->rotors;
  case 'r': /* rho, and the number of what a stage depends on */
    return 10 + 2 * (w->n + w->rotors);
  case 'l': /* L */
    return 13 + 2 * (w->n + w->rotors);
  case 'w': /* what rates tell of the frame, and the rotation by rotors and gravity that a step has to resolve */
    return (w->large ? 12 : 3) + (w->rotors > 0 || w->central);
  default: /* N: all */
    return 16 + 2 * (w->n + w->rotors);
  }
}

static int code_is_letter(char c)
{
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/* Where parameters vary a % and M, A, Q, V mean the model as what a function takes, as what it is given, that there is
   none, that it may be unused; X: const where the mass does not vary. 0: another letter. */
static int code_model_text(const code *w, char letter)
{
  if (!strchr("MAQVX", letter)) {
    return 0;
  }
  if (letter == 'X') {
    fputs(w->vary & CODE_MASS ? "" : "const ", w->out);
  } else if (w->vary && letter == 'M') {
    fprintf(w->out, "const %s%s_model *model, ", w->name, w->lanes == CODE_WIDE ? "_wide" : w->lanes ? "_lanes" : "");
  } else if (w->vary) {
    fputs(letter == 'A' ? "model, " : letter == 'Q' ? " || !model" : "  (void)model;\n", w->out);
  }
  return 1;
}

/* A prefix: of what is for lanes, where what follows it is not common to all. */
static void code_prefix(const code *w, const char *text)
{
  static const char *const common[] = {
      "_status", "_ok",       "_null",    "_value",       "_not_finite", "_step_length",   "_range",
      "_UNROLL", "_NOINLINE", "_huge",    "_tiny",        "_faint",      "_contradiction", "_ROWS",
      "_loose",  "_lost",     "_epsilon", "_convergence", "_ITERATIONS", "_RESTRICT",      "_ALIGNED"};
  const char *suffix = w->lanes == CODE_WIDE ? "_wide" : w->lanes ? "_lanes" : "";
  for (size_t k = 0; k < sizeof common / sizeof *common; k++) {
    const size_t length = strlen(common[k]);
    if (strncmp(text, common[k], length) == 0 && !code_is_letter(text[length])) {
      suffix = "";
    }
  }
  fprintf(w->out, "%s%s", w->name, suffix);
}

/* Functions of libm in a template: those of all lanes at once. How many characters these are; 0: there is none. */
static int code_libm(const code *w, const char *text)
{
  if (w->lanes && (strncmp(text, "sqrt~", 5) == 0 || strncmp(text, "fabs~", 5) == 0)) {
    fprintf(w->out, "%s_wide_%s", w->name, text[0] == 's' ? "sqrt" : "abs");
    return 5;
  }
  return 0;
}

/* What % and a letter mean in a template, of one body and with lanes; @ is the prefix, $ the type, ' the suffix of
   numbers. 0: another letter. */
static int code_lane_text(const code *w, char letter)
{
  static const struct {
    char letter;
    const char *one, *wide;
  } texts[] = {{'s', "#", "#"},                   /* type of one body */
               {'z', "0.0'", "@_wide_all(0.0')"}, /* zero */
               {'(', "", "@_wide_every("},        /* a condition.. */
               {')', "", ")"},                    /* ..that holds for every lane */
               {'T', "known[", "@_wide_where("},  /* 1 where a condition.. */
               {'t', "]", ", @_wide_all(1.0'))"}, /* ..holds, else 0 */
               {'K', "  static const # known[2] = {0.0', 1.0'};\n", ""},
               {'W', "", "@_wide_where("},   /* where a condition.. */
               {',', " ? ", ", "},           /* ..holds this value.. */
               {'!', " : 0.0'", ")"},        /* ..else 0 */
               {'F', "", "@_wide_where(~("}, /* where a condition.. */
               {':', " ? 0.0' : ", "), "},   /* ..holds 0, else this value.. */
               {';', "", ")"},               /* ..and its end */
               {'Z', " = {0.0'}", ""},       /* an array of zeros.. */
               {'0', "", "  memset(sum, 0, sizeof sum);\n  memset(first, 0, sizeof first);\n"},
               {'*', "", "*"}, /* what is passed by a pointer with lanes */
               {'&', "", "&"},
               {'S', "", "static "}};
  for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
    if (texts[k].letter == letter) {
      for (const char *c = w->lanes ? texts[k].wide : texts[k].one; *c; c++) {
        if (*c == '@' || *c == '#') {
          fputs(*c == '@' ? w->name : code_scalar(w), w->out);
        } else if (*c != '\'' || w->single) {
          fputc(*c == '\'' ? 'f' : *c, w->out);
        }
      }
      return 1;
    }
  }
  return 0;
}

/* Text in which @ is the prefix, $ the type, ~ the suffix of libm's functions, %letter a number of code_place or a text
   of code_model_text or code_lane_text, and a number between ` is written in the target's precision. */
static void code_template(const code *w, const char *text)
{
  char number[40];
  for (const char *c = text; *c; c++) {
    const int known = code_libm(w, c);
    if (known > 0) {
      c += known - 1;
    } else if (*c == '@') {
      code_prefix(w, c + 1);
    } else if (*c == '$') {
      fputs(code_real(w), w->out);
    } else if (*c == '~') {
      fputs(w->single ? "f" : "", w->out);
    } else if (*c == '%') {
      c++;
      if (*c == '%') {
        fputc('%', w->out);
      } else if (*c == 'e') { /* rounding of the precision */
        code_number(number, w, w->single ? (double)FLT_EPSILON : DBL_EPSILON);
        fputs(number, w->out);
      } else if (!code_model_text(w, *c) && !code_lane_text(w, *c)) {
        fprintf(w->out, "%d", code_place(w, *c));
      }
    } else if (*c == '`') {
      code_number(number, w, strtod(c + 1, NULL));
      fputs(number, w->out);
      c = strchr(c + 1, '`');
    } else {
      fputc(*c, w->out);
    }
  }
}

/* ---- variables that nothing uses are left out: statements of a function, read from its end */

enum { CODE_SEEN = 1 << 16, CODE_LINE = 512, CODE_LINES = 60000 };

typedef struct code_seen { /* names that are used */
  int n;
  char name[CODE_SEEN][CODE_NAME];
} code_seen;

/* Where a name stands, or would stand, in the table. */
static char *code_find(code_seen *seen, const char *name, int length)
{
  unsigned at = 5381u;
  for (int i = 0; i < length; i++) {
    at = 33u * at + (unsigned char)name[i];
  }
  for (at %= CODE_SEEN; seen->name[at][0]; at = (at + 1) % CODE_SEEN) {
    if (strncmp(seen->name[at], name, (size_t)length) == 0 && seen->name[at][length] == '\0') {
      break;
    }
  }
  return seen->name[at];
}

/* The names in a line are used; that which it defines, behind `from`, is not among them. */
static void code_see(code_seen *seen, const char *line, const char *from)
{
  for (const char *c = from ? strchr(from, '=') : line; *c; c++) {
    int length = 0;
    while (code_is_letter(c[length])) {
      length++;
    }
    if (length > 0 && length < CODE_NAME) {
      char *const at = code_find(seen, c, length);
      if (seen->n < CODE_SEEN / 2 && !at[0]) {
        memcpy(at, c, (size_t)length);
        seen->n++;
      }
    }
    c += length > 0 ? length - 1 : 0;
  }
}

/* Name that a line defines as the only one, a constant of that type; NULL: none. */
static const char *code_defined(const char *line, const char *type)
{
  const char *c = line + strspn(line, " ");
  const size_t length = strlen(type);
  if (strncmp(c, "const ", 6) != 0 || strncmp(c + 6, type, length) != 0 || c[6 + length] != ' ') {
    return NULL;
  }
  c += 7 + length;
  return code_is_letter(*c) && strchr(c, '=') && !strchr(strchr(c, '=') + 1, '=') ? c : NULL;
}

/* Copies `in` to `out`, without definitions of what is used nowhere. 0: too long. */
static int code_prune(FILE *out, FILE *in, const char *type)
{
  static char line[CODE_LINES][CODE_LINE];
  static char keep[CODE_LINES];
  static code_seen seen;
  int n = 0;
  memset(&seen, 0, sizeof seen);
  rewind(in);
  while (n < CODE_LINES && fgets(line[n], CODE_LINE, in)) {
    n++;
  }
  for (int end = n - 1, first; end >= 0; end = first - 1) {
    const char *name;
    int length = 0;
    for (first = end; first > 0 && strncmp(line[first], "      ", 6) == 0 && !strchr(line[first - 1], ';'); first--) {
    }
    name = code_defined(line[first], type);
    while (name && code_is_letter(name[length])) {
      length++;
    }
    for (int i = first; i <= end; i++) {
      keep[i] = (char)(!name || code_find(&seen, name, length)[0]);
    }
    for (int i = first; i <= end && keep[first]; i++) {
      code_see(&seen, line[i], i == first ? name : NULL);
    }
  }
  for (int i = 0; i < n; i++) {
    fputs(keep[i] ? line[i] : "", out);
  }
  return n < CODE_LINES && seen.n < CODE_SEEN / 2;
}

/* Writes a function by `write`, without what nothing in it uses; 0: no temporary file, or too long, see errno. */
static int code_write_pruned(const code *w, void (*write)(const code *, int), int k)
{
  code draft = *w;
  int good;
  if (w->vary & CODE_TABLE && code_numbers.value) { /* nobody reads it */
    write(w, k);
    return 1;
  }
  draft.out = tmpfile();
  if (!draft.out) {
    return 0;
  }
  write(&draft, k);
  good = code_prune(w->out, draft.out, code_real(w));
  errno = good ? errno : EFBIG;
  return fclose(draft.out) == 0 && good;
}

/* As much of a template as the precision wants. */
static void code_template_of(const code *w, int single, const char *text)
{
  if (w->single == single) {
    code_template(w, text);
  }
}
#endif
