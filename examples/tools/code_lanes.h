/* code_lanes.h - the step of code.h for several bodies of one description at once, one to a lane: the types of lanes,
   vectors of the compiler, and what puts both together. The equations are those of code.h, written a second time with
   vectors.

   A vector step is of all lanes or of none: where a check fails in a lane, every lane takes the step of one body
   instead, which tells its status. Both have the same operations in the same order, hence the same bits. */
#ifndef CODE_LANES_H
#define CODE_LANES_H
#include "code_text.h"

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
    "typedef struct @_lane {\n  %s lane[@_LANES];\n} @_lane;\n\n";

static const char code_lanes_declarations[] =
    "/* One body to and from a lane. */\n"
    "void @_lanes_put(@_lanes_state *lanes, int lane, const @_state *state);\n"
    "void @_lanes_take(@_state *state, const @_lanes_state *lanes, int lane);\n"
    "%P"
    "/* @_step of each lane; status: of each, or NULL. Returns @_ok, or the first that is not: such a lane stays as it "
    "was,\n"
    "   the others go on. As long as there is one all take the time of single steps: put another state there. */\n"
    "@_status @_lanes_step(%L@_lanes_state *state, const @_lanes_input *start, %mconst @_lanes_input *end,\n"
    "                      %s dt, @_status status[@_LANES]);\n";

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
    "typedef %s @_wide __attribute__((vector_size(@_LANES * sizeof(%s))));\n"
    "typedef %I @_wide_mask __attribute__((vector_size(@_LANES * sizeof(%s))));\n"
    "#define @_wide_all(c) ((@_wide){0} + (c))\n"
    "#define @_wide_where(mask, x) ((@_wide)((@_wide_mask)(x) & (@_wide_mask)(mask)))\n"
    "#define @_wide_abs(x) ((@_wide)((@_wide_mask)(x) & %H))\n\n"
    "/* Vectors are passed by pointers, which is the same to every machine. */\n"
    "#define @_wide_sqrt(x) (*@_wide_root((@_wide[1]){x}))\n"
    "#define @_wide_norm(x) @_wide_sqrt((x)[0] * (x)[0] + (x)[1] * (x)[1] + (x)[2] * (x)[2])\n"
    "#define @_wide_every(mask) @_wide_hold((const @_wide_mask[1]){mask})\n\n"
    "static inline @_wide *@_wide_root(@_wide *x)\n{\n"
    "#ifdef @_wide_roots\n  *x = @_wide_roots(*x);\n#else\n"
    "  for (int k = 0; k < @_LANES; k++) {\n    (*x)[k] = sqrt~((*x)[k]);\n  }\n#endif\n  return x;\n}\n\n"
    "static inline int @_wide_hold(const @_wide_mask *mask)\n{\n"
    "  %I all = -1;\n"
    "  for (int k = 0; k < @_LANES; k++) {\n    all &= (*mask)[k];\n  }\n  return all != 0;\n}\n\n";

/* Angles of joints, lane by lane; a choice between two values. */
static const char code_lanes_angles[] =
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
    "  for (int k = 0; k < @_LANES; k++) {\n    (*y)[k] = atan2~((*y)[k], (*x)[k]);\n  }\n  return y;\n}\n\n";

/* What a trace may use beside. */
static const char code_lanes_traced[] =
    "/* Where numbers of a model are, which is not aligned as vectors are. */\n"
    "typedef struct {\n  @_wide v;\n} __attribute__((packed, aligned(sizeof(%s)), may_alias)) @_wide_loose;\n\n"
    "#define @_wide_exp(x) (*@_wide_power((@_wide[1]){x}))\n"
    "#define @_wide_trunc(x) (*@_wide_whole((@_wide[1]){x}))\n\n"
    "static inline @_wide *@_wide_power(@_wide *x)\n{\n"
    "  for (int k = 0; k < @_LANES; k++) {\n    (*x)[k] = exp~((*x)[k]);\n  }\n  return x;\n}\n\n"
    "static inline @_wide *@_wide_whole(@_wide *x)\n{\n"
    "  for (int k = 0; k < @_LANES; k++) {\n    (*x)[k] = (%s)(int)(*x)[k];\n  }\n  return x;\n}\n\n";

static const char code_lanes_copies[] =
    "\n/* Structs of numbers alone: those of one body, and of lanes. */\n"
    "static void @_lanes_copy(void *lanes, const void *one, size_t size, int lane)\n{\n"
    "  for (size_t i = 0; i < size / sizeof(%s); i++) {\n"
    "    memcpy((char *)lanes + (i * @_LANES + (size_t)lane) * sizeof(%s), (const char *)one + i * sizeof(%s), "
    "sizeof(%s));\n"
    "  }\n}\n\n"
    "static void @_lanes_back(void *one, const void *lanes, size_t size, int lane)\n{\n"
    "  for (size_t i = 0; i < size / sizeof(%s); i++) {\n"
    "    memcpy((char *)one + i * sizeof(%s), (const char *)lanes + (i * @_LANES + (size_t)lane) * sizeof(%s), "
    "sizeof(%s));\n"
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
    "static @_status @_lanes_together(%L@_lanes_state *state, const @_lanes_input *const in[%c], %s dt)\n{\n"
    "  @_wide_state wide;\n"
    "  @_wide_input acts[%c];\n"
    "  const @_wide_input *given[%c];\n"
    "  @_status status;\n"
    "%C"
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
    "\n@_status @_lanes_step(%L@_lanes_state *state, const @_lanes_input *start, %mconst @_lanes_input *end,\n"
    "                      %s dt, @_status status[@_LANES])\n{\n"
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

/* A template with letters of its own. */
static void code_lanes_template(const code *w, const char *text)
{
  static const struct {
    char letter;
    const char *text;
  } varied[] = {{'L', "const @_lanes_model *model, "},
                {'P', "void @_lanes_put_model(@_lanes_model *lanes, int lane, const @_model *model);\n"},
                {'C', "  @_wide_model parameters;\n  memcpy(&parameters, model, sizeof parameters);\n"},
                {'B', "&parameters, "},
                {'D', "    @_model parameters;\n    @_lanes_back(&parameters, model, sizeof parameters, k);\n"},
                {'E', "&parameters, "}};
  for (const char *c = text; *c; c++) {
    char piece[3] = {c[0], 0, 0};
    const char *own = NULL;
    if (c[0] == '%') {
      piece[1] = *++c;
      own = *c == 'I'   ? (w->single ? "int" : "long long")
            : *c == 'H' ? (w->single ? "0x7fffffff" : "0x7fffffffffffffff")
            : *c == 'c' ? (w->ends ? "2" : "3")
            : *c == 'm' ? (w->ends ? "" : "const @_lanes_input *middle, ")
            : *c == 'i' ? (w->ends ? "" : "middle, ")
            : *c == 'g' ? (w->ends ? "given[0], given[1]" : "given[0], given[1], given[2]")
                        : NULL;
      for (size_t k = 0; k < sizeof varied / sizeof *varied; k++) {
        own = varied[k].letter == *c ? (w->vary ? varied[k].text : "") : own;
      }
      if ((w->vary & CODE_TABLE || w->traced) && w->vary &&
          (*c == 'B' || *c == 'C')) { /* a table is not copied: it is aligned */
        own = *c == 'B' ? "(const @_wide_model *)(const void *)model, " : "";
      }
    }
    code_template(w, own ? own : piece);
  }
}

/* What stands before the functions of all lanes at once but for their types. */
static inline code code_lanes_begin(const code *w)
{
  code wide = *w;
  wide.lanes = CODE_WIDE;
  code_lanes_template(w, code_lanes_if);
  code_lanes_template(w, code_lanes_roots[w->single]);
  code_lanes_template(w, code_lanes_vectors);
  return wide;
}

/* What stands behind them: the step that takes them. */
static inline void code_lanes_end(const code *w)
{
  code_lanes_template(w, code_lanes_together);
  code_lanes_template(w, code_lanes_copies);
  code_lanes_template(w, w->vary ? code_lanes_put_model : "");
  code_lanes_template(w, code_lanes_step);
}
#endif
