/* code.h - what stands around the functions of a step that trace/ writes: text with the names and types of the one who
   includes it, and the step of several models at once, one to a lane. Include flexbeam.h first. */
#ifndef CODE_H
#define CODE_H
#include "trace/trace.h"
#include <stdlib.h>
#include <string.h>

typedef char node_sets_hold_all_nodes[FB_MAX_NODES <= NODE_SET ? 1 : -1];

enum { CODE_PREFIX = 200 };

enum { CODE_ONE, CODE_LANES, CODE_WIDE }; /* types of one model; of several, by lanes; of their step by vectors */

typedef struct code {
  FILE *out;
  const char *name; /* prefix of what is written */
  int single;
  int lanes;    /* CODE_.. */
  int implicit; /* 1: a step is told what acts at its start and end, 0: at its middle, too */
  int vary;     /* bits of parameters that stay variable (code_body.h) */
  int places;   /* numbers of the model that vary */
} code;

/* Type of a real number of one model. */
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

/* c with all its digits, in the precision of the target. */
static void code_number(const code *w, double c)
{
  char text[40];
  snprintf(text, sizeof text, w->single ? "%.9g" : "%.17g", w->single ? (double)(float)c : c);
  fprintf(w->out, "%s%s%s", text, strpbrk(text, ".en") ? "" : ".0", w->single ? "f" : "");
}

/* A prefix: of the structs of lanes, where they are meant. */
static void code_prefix(const code *w, const char *text)
{
  static const char *const own[] = {"_state", "_input", "_model"};
  const char *suffix = "";
  for (size_t k = 0; k < sizeof own / sizeof *own && w->lanes; k++) {
    if (strncmp(text, own[k], 6) == 0) {
      suffix = w->lanes == CODE_WIDE ? "_wide" : "_lanes";
    }
  }
  fprintf(w->out, "%s%s", w->name, suffix);
}

/* What % and a letter mean in a template; NULL: another letter. */
static const char *code_letter(const code *w, char letter)
{
  const struct {
    char letter;
    const char *no, *yes;
    int is;
  } texts[] = {
      {'r', "double", "float", w->single},
      {'I', "long long", "int", w->single},
      {'H', "0x7fffffffffffffff", "0x7fffffff", w->single},
      {'c', "3", "2", w->implicit}, /* what acts: at so many instants.. */
      {'n', "const @_lanes_input *middle, ", "", w->implicit},
      {'i', "middle, ", "", w->implicit},
      {'g', "given[0], given[1], given[2]", "given[0], given[1]", w->implicit},
      {'M', "", "const @_model *model, ", w->vary}, /* the model, where numbers of it vary.. */
      {'A', "", "model, ", w->vary},
      {'Q', "", " || !model", w->vary},
      {'L', "", "const @_lanes_model *model, ", w->vary},
      {'P', "", "void @_lanes_put_model(@_lanes_model *lanes, int lane, const @_model *model);\n", w->vary},
      {'B', "", "(const @_wide_model *)(const void *)model, ", w->vary},
      {'D', "", "    @_model parameters;\n    @_lanes_back(&parameters, model, sizeof parameters, k);\n", w->vary},
      {'E', "", "&parameters, ", w->vary}};
  for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
    if (texts[k].letter == letter) {
      return texts[k].is ? texts[k].yes : texts[k].no;
    }
  }
  return NULL;
}

/* Text in which @ is the prefix, $ the type, ~ the suffix of libm's functions, % and a letter that of code_letter and a number
   between ` is written in the target's precision. */
static void code_template(const code *w, const char *text)
{
  for (const char *c = text; *c; c++) {
    const char *const own = *c == '%' ? code_letter(w, c[1]) : NULL;
    if (own) {
      code_template(w, own);
      c++;
    } else if (*c == '@') {
      code_prefix(w, c + 1);
    } else if (*c == '$') {
      fputs(code_real(w), w->out);
    } else if (*c == '~') {
      fputs(w->single ? "f" : "", w->out);
    } else if (*c == '`') {
      code_number(w, strtod(c + 1, NULL));
      c = strchr(c + 1, '`');
    } else {
      fputc(*c, w->out);
    }
  }
}

/* A list of numbers of a struct; n = 0: none. */
static void code_member(const code *w, int indent, const char *name, int n, const char *what)
{
  if (n > 0) {
    fprintf(w->out, "%*s%s %s[%d];", indent, "", code_real(w), name, n);
    fprintf(w->out, what ? " /* %s */\n" : "\n", what);
  }
}

static const char code_node_type[] = "typedef struct @_node { /* inertial axes */\n"
                                     "  $ position[3], quat[4];         /* [m], attitude of the section */\n"
                                     "  $ velocity[3], angular_rate[3]; /* [m/s], [rad/s] */\n"
                                     "} @_node;\n\n";

static const char code_energy_type[] = "typedef struct @_energy {\n"
                                       "  $ kinetic, strain, gravity; /* [J]; gravity is that of the description */\n"
                                       "} @_energy;\n\n";

/* ---- several models at once, by vectors: of all lanes or of none. Where a check fails in a lane, every lane takes the
   step of one model instead, which tells its status. Both have the same operations in the same order, hence the same
   bits. */

static const char code_lanes_width[] =
    "\n/* Lanes: so many bodies at once, 1, 2, 4 or 8, by vectors of gcc and clang (implementation in C), else one by "
    "one: the same\n"
    "   bits for any number. The same @_LANES in all files; without it what fits the machine. */\n"
    "#ifndef @_LANES\n"
    "#if defined(__AVX512F__)\n#define @_LANES 8\n#elif defined(__AVX__)\n#define @_LANES 4\n#else\n#define @_LANES "
    "2\n#endif\n"
    "#endif\n"
    "#if @_LANES != 1 && @_LANES != 2 && @_LANES != 4 && @_LANES != 8\n"
    "#error \"@_LANES is 1, 2, 4 or 8\"\n#endif\n\n"
    "typedef struct @_lane {\n  %r lane[@_LANES];\n} @_lane;\n\n";

static const char code_lanes_declarations[] =
    "/* One body to and from a lane. */\n"
    "void @_lanes_put(@_lanes_state *lanes, int lane, const @_state *state);\n"
    "void @_lanes_take(@_state *state, const @_lanes_state *lanes, int lane);\n"
    "%P"
    "/* @_step of each lane; status: of each, or NULL. Returns @_ok, or the first that is not: such a lane stays as it "
    "was,\n"
    "   the others go on. As long as there is one all take the time of single steps: put another state there. */\n"
    "@_status @_lanes_step(%L@_lanes_state *state, const @_lanes_input *start, %nconst @_lanes_input *end,\n"
    "                      %r dt, @_status status[@_LANES]);\n";

static const char code_lanes_if[] = "\n#if defined(__GNUC__) && !defined(__cplusplus) && @_LANES > 1\n"
                                    "#define @_WIDE 1\n";

/* Square roots of all lanes by one instruction, which sets no errno: the same bits. By precision. */
static const char *const code_lanes_roots[2] = {
    "#if defined(__clang__) && defined(__has_builtin)\n"
    "#if __has_builtin(__builtin_elementwise_sqrt)\n#define @_wide_roots __builtin_elementwise_sqrt\n#endif\n"
    "#elif @_LANES == 2 && defined(__SSE2__)\n#define @_wide_roots __builtin_ia32_sqrtpd\n"
    "#elif @_LANES == 4 && defined(__AVX__)\n#define @_wide_roots __builtin_ia32_sqrtpd256\n"
    "#elif @_LANES == 8 && defined(__AVX512F__)\n"
    "#define @_wide_roots(x) __builtin_ia32_sqrtpd512_mask(x, x, -1, 4)\n#endif\n\n",
    "#if defined(__clang__) && defined(__has_builtin)\n"
    "#if __has_builtin(__builtin_elementwise_sqrt)\n#define @_wide_roots __builtin_elementwise_sqrt\n#endif\n"
    "#elif @_LANES == 4 && defined(__SSE__)\n#define @_wide_roots __builtin_ia32_sqrtps\n"
    "#elif @_LANES == 8 && defined(__AVX__)\n#define @_wide_roots __builtin_ia32_sqrtps256\n#endif\n\n"};

static const char code_lanes_vectors[] =
    "typedef %r @_wide __attribute__((vector_size(@_LANES * sizeof(%r))));\n"
    "typedef %I @_wide_mask __attribute__((vector_size(@_LANES * sizeof(%r))));\n"
    "#define @_wide_all(c) ((@_wide){0} + (c))\n"
    "#define @_wide_where(mask, x) ((@_wide)((@_wide_mask)(x) & (@_wide_mask)(mask)))\n"
    "#define @_wide_abs(x) ((@_wide)((@_wide_mask)(x) & %H))\n\n"
    "/* Vectors are passed by pointers, which is the same to every machine. */\n"
    "#define @_wide_sqrt(x) (*@_wide_root((@_wide[1]){x}))\n"
    "#define @_wide_every(mask) @_wide_hold((const @_wide_mask[1]){mask})\n\n"
    "static inline @_wide *@_wide_root(@_wide *x)\n{\n"
    "#ifdef @_wide_roots\n  *x = @_wide_roots(*x);\n#else\n"
    "  for (int k = 0; k < @_LANES; k++) {\n    (*x)[k] = sqrt~((*x)[k]);\n  }\n#endif\n  return x;\n}\n\n"
    "static inline int @_wide_hold(const @_wide_mask *mask)\n{\n"
    "  %I all = -1;\n"
    "  for (int k = 0; k < @_LANES; k++) {\n    all &= (*mask)[k];\n  }\n  return all != 0;\n}\n\n"
    /* angles of joints, lane by lane; a choice between two values */
    "#define @_wide_cos(x) (*@_wide_cosine((@_wide[1]){x}))\n"
    "#define @_wide_sin(x) (*@_wide_sine((@_wide[1]){x}))\n"
    "#define @_wide_atan2(y, x) (*@_wide_angle((@_wide[1]){y}, (const @_wide[1]){x}))\n"
    "#define @_wide_either(mask, x, y) \\\n"
    "  ((@_wide)((@_wide_mask)(y) ^ (((@_wide_mask)(x) ^ (@_wide_mask)(y)) & (@_wide_mask)(mask))))\n\n"
    "static inline @_wide *@_wide_cosine(@_wide *x)\n{\n"
    "  for (int k = 0; k < @_LANES; k++) {\n    (*x)[k] = cos~((*x)[k]);\n  }\n  return x;\n}\n\n"
    "static inline @_wide *@_wide_sine(@_wide *x)\n{\n"
    "  for (int k = 0; k < @_LANES; k++) {\n    (*x)[k] = sin~((*x)[k]);\n  }\n  return x;\n}\n\n"
    "static inline @_wide *@_wide_angle(@_wide *y, const @_wide *x)\n{\n"
    "  for (int k = 0; k < @_LANES; k++) {\n    (*y)[k] = atan2~((*y)[k], (*x)[k]);\n  }\n  return y;\n}\n\n"
    "/* Where numbers of a model are, which is not aligned as vectors are. */\n"
    "typedef struct {\n  @_wide v;\n} __attribute__((packed, aligned(sizeof(%r)), may_alias)) @_wide_loose;\n\n"
    "#define @_wide_exp(x) (*@_wide_power((@_wide[1]){x}))\n"
    "#define @_wide_trunc(x) (*@_wide_whole((@_wide[1]){x}))\n\n"
    "static inline @_wide *@_wide_power(@_wide *x)\n{\n"
    "  for (int k = 0; k < @_LANES; k++) {\n    (*x)[k] = exp~((*x)[k]);\n  }\n  return x;\n}\n\n"
    "static inline @_wide *@_wide_whole(@_wide *x)\n{\n"
    "  for (int k = 0; k < @_LANES; k++) {\n    (*x)[k] = (%r)(int)(*x)[k];\n  }\n  return x;\n}\n\n";

static const char code_lanes_copies[] =
    "\n/* Structs of numbers alone: those of one body, and of lanes. */\n"
    "static void @_lanes_copy(void *lanes, const void *one, size_t size, int lane)\n{\n"
    "  for (size_t i = 0; i < size / sizeof(%r); i++) {\n"
    "    memcpy((char *)lanes + (i * @_LANES + (size_t)lane) * sizeof(%r), (const char *)one + i * sizeof(%r), "
    "sizeof(%r));\n"
    "  }\n}\n\n"
    "static void @_lanes_back(void *one, const void *lanes, size_t size, int lane)\n{\n"
    "  for (size_t i = 0; i < size / sizeof(%r); i++) {\n"
    "    memcpy((char *)one + i * sizeof(%r), (const char *)lanes + (i * @_LANES + (size_t)lane) * sizeof(%r), "
    "sizeof(%r));\n"
    "  }\n}\n\n"
    "void @_lanes_put(@_lanes_state *lanes, int lane, const @_state *state)\n{\n"
    "  if (lanes && state && lane >= 0 && lane < @_LANES) {\n    @_lanes_copy(lanes, state, sizeof *state, lane);\n  "
    "}\n}\n\n"
    "void @_lanes_take(@_state *state, const @_lanes_state *lanes, int lane)\n{\n"
    "  if (lanes && state && lane >= 0 && lane < @_LANES) {\n    @_lanes_back(state, lanes, sizeof *state, lane);\n  "
    "}\n}\n";

static const char code_lanes_put_model[] =
    "\nvoid @_lanes_put_model(@_lanes_model *lanes, int lane, const @_model *model)\n{\n"
    "  if (lanes && model && lane >= 0 && lane < @_LANES) {\n    @_lanes_copy(lanes, model, sizeof *model, lane);\n  "
    "}\n}\n";

static const char code_lanes_together[] =
    "\n/* The step of all lanes by vectors; another status than @_ok: nothing has changed. */\n"
    "static @_status @_lanes_together(%L@_lanes_state *state, const @_lanes_input *const in[%c], %r dt)\n{\n"
    "  @_wide_state wide;\n"
    "  @_wide_input acts[%c];\n"
    "  const @_wide_input *given[%c];\n"
    "  @_status status;\n"
    "  memcpy(&wide, state, sizeof wide);\n"
    "  for (int k = 0; k < %c; k++) {\n"
    "    given[k] = k > 0 && in[k] == in[0]     ? given[0]\n"
    "               : k > 0 && in[k] == in[k - 1] ? given[k - 1]\n"
    "               : in[k]                       ? &acts[k]\n"
    "                                             : NULL;\n"
    "    if (given[k] == &acts[k]) {\n      memcpy(&acts[k], in[k], sizeof acts[k]);\n    }\n  }\n"
    "  status = @_wide_step(%B&wide, %g, dt);\n"
    "  if (status == @_ok) {\n    memcpy(state, &wide, sizeof wide);\n  }\n"
    "  return status;\n}\n"
    "#endif\n";

static const char code_lanes_step[] =
    "\n@_status @_lanes_step(%L@_lanes_state *state, const @_lanes_input *start, %nconst @_lanes_input *end,\n"
    "                      %r dt, @_status status[@_LANES])\n{\n"
    "  const @_lanes_input *const in[%c] = {start, %iend};\n"
    "  @_status worst = @_ok;\n"
    "  if (!state%Q) {\n    for (int k = 0; k < @_LANES && status; k++) {\n      status[k] = @_null;\n    }\n"
    "    return @_null;\n  }\n"
    "#ifdef @_WIDE\n"
    "  if (@_lanes_together(%Astate, in, dt) == @_ok) {\n"
    "    for (int k = 0; k < @_LANES && status; k++) {\n      status[k] = @_ok;\n    }\n"
    "    return @_ok;\n  }\n"
    "#endif\n"
    "  for (int k = 0; k < @_LANES; k++) {\n"
    "    @_state own;\n"
    "    @_input acts[%c];\n"
    "    const @_input *given[%c];\n"
    "    @_status one;\n"
    "%D"
    "    for (int i = 0; i < %c; i++) {\n"
    "      given[i] = i > 0 && in[i] == in[0] ? given[0] : in[i] ? &acts[i] : NULL;\n"
    "      if (in[i]) {\n        @_lanes_back(&acts[i], in[i], sizeof acts[i], k);\n      }\n    }\n"
    "    @_lanes_take(&own, state, k);\n"
    "    one = @_step(%E&own, %g, dt);\n"
    "    @_lanes_put(state, k, &own);\n"
    "    worst = worst == @_ok ? one : worst;\n"
    "    if (status) {\n      status[k] = one;\n    }\n  }\n"
    "  return worst;\n}\n";

/* Declarations of several models at once; types: writes those of a state and what acts. */
static inline void code_write_lanes(const code *w, void (*types)(const code *))
{
  code lane = *w;
  lane.lanes = CODE_LANES;
  code_template(w, code_lanes_width);
  types(&lane);
  code_template(w, code_lanes_declarations);
}

/* Vectors, and the types of all lanes. */
static void code_write_vectors(const code *w, void (*types)(const code *))
{
  code wide = *w;
  wide.lanes = CODE_WIDE;
  code_template(w, code_lanes_roots[w->single]);
  code_template(w, code_lanes_vectors);
  types(&wide);
}

/* gcc -O1 does not see that results of a function are set where its status is ok. */
static const char code_quiet[] = "\n#if defined(__GNUC__) && !defined(__clang__)\n#pragma GCC diagnostic push\n"
                                 "#pragma GCC diagnostic ignored \"-Wmaybe-uninitialized\"\n#endif\n\n";

static const char code_quiet_end[] =
    "#if defined(__GNUC__) && !defined(__clang__)\n#pragma GCC diagnostic pop\n#endif\n#endif\n";

/* The functions whose declarations stand above, to the end of the file. 0, or 1 with why in text. */
static inline int code_write_steps(const code *w, trace_choice choice, const trace_model *of, int lanes,
                                   void (*types)(const code *), char text[400])
{
  int (*const trace)(FILE *, const trace_choice *, const trace_model *, char[400]) =
      w->single ? trace_step_single : trace_step;
  int bad;
  fputs(code_quiet, w->out);
  bad = trace(w->out, &choice, of, text);
  if (lanes && !bad) {
    code_template(w, code_lanes_if);
    code_write_vectors(w, types);
    choice.wide = 1;
    bad = trace(w->out, &choice, of, text);
    code_template(w, code_lanes_together);
    code_template(w, code_lanes_copies);
    code_template(w, w->vary ? code_lanes_put_model : "");
    code_template(w, code_lanes_step);
  }
  fputs(code_quiet_end, w->out);
  return bad;
}
#endif
