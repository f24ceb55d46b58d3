/* steps.h - functions of the library as C functions of a file: each is traced, and kernels that they have in common are written
   once. */
#ifndef TRACE_STEPS_H
#define TRACE_STEPS_H
#include "apart.h"
#include "factor.h"
#include "loop_text.h"
#include "replay.h"
#include "trace.h"
#include <memory>

namespace trace
{

/* A traced function, with what stands around it in the text. */
struct traced {
  std::string head, before, after; /* before: the results */
  recording made;
  std::vector<std::pair<std::string, number>> results;
  std::vector<std::string> names;   /* of the inputs */
  std::vector<std::string> pointer; /* to inputs that may not be given */
  std::vector<unsigned> given;      /* by input, bits of these */
  bool beside = false;              /* written elsewhere */
};

/* start->, middle->, end-> and in-> are NULL, or of numbers. */
static unsigned bit_of_pointer(std::vector<std::string> &pointer, const std::string &name)
{
  for (const char *own : {"start", "middle", "end", "in"}) {
    if (name.compare(0, std::strlen(own) + 2, std::string(own) + "->") == 0) {
      const std::string text = std::string(own) + " != &none";
      const auto found = std::find(pointer.begin(), pointer.end(), text);
      const std::size_t at = (std::size_t)(found - pointer.begin());
      if (found == pointer.end()) {
        pointer.push_back(text);
      }
      return 1u << at;
    }
  }
  return 0u;
}

/* A check that nothing is beyond the largest number, of numbers that nothing else needs; in their place one of the results. */
static void leave_out_checks(const std::vector<number> &results)
{
  graph &g = R.all[0];
  bool any = false;
  std::vector<guard> all = g.guards;
  for (guard &c : g.guards) {
    c.status = c.status == FB_ERR_NOT_FINITE ? 0 : c.status;
  }
  const std::vector<char> live = needed(g, results, true);
  for (std::size_t k = 0; k < all.size(); k++) {
    bool needed_too = true;
    std::vector<number> sum = {all[k].a, all[k].b};
    while (!sum.empty()) { /* of sizes */
      const number a = sum.back();
      const node &n = g.nodes[(std::size_t)node_of(a)];
      sum.pop_back();
      if (node_of(a) && !live[(std::size_t)node_of(a)] && std::strchr("+fi", n.op)) {
        sum.insert(sum.end(), {n.op == 'i' ? number(0.0) : n.a, n.op == '+' ? n.b : number(0.0)});
      } else {
        needed_too = needed_too && (!node_of(a) || live[(std::size_t)node_of(a)]);
      }
    }
    g.guards[k].status = needed_too ? all[k].status : g.guards[k].status;
    any = any || g.guards[k].status != all[k].status;
  }
  number sum = 0.0;
  for (std::size_t k = 0; k < results.size() && any; k++) {
    const number size = node_of(results[k]) ? make('f', results[k], 0.0, 0.0) : 0.0;
    sum = node_of(sum) && node_of(size) ? make('+', sum, size, 0.0) : node_of(size) ? size : sum;
  }
  if (node_of(sum)) {
    g.guards.push_back({'l', sum, FB_HUGE, true, (int)g.nodes.size() - 1, R.n_asked++, FB_ERR_NOT_FINITE, ""});
  }
}

/* Traces a function; "", or why it cannot be written. */
static std::string trace_function(traced &t, subject &s, const std::string &name)
{
  std::vector<number> results;
  std::vector<std::string> names;
  fb_status status = FB_OK;
  if (!find_state(s, status)) {
    return name + ": no state near the start that the library steps: " + refused_by(status);
  }
  still.clear();
  do {
    names.clear();
    status = run(s, 0, -1, results, &names, LOOPS);
    if (status != FB_OK) {
      return name + ": " + refused_by(status);
    }
  } while (find_still());
  if (R.conversions > 0) {
    return name + ": the library rounds a number of this model to a whole one";
  }
  judge_guards(s, 0, results, LOOPS);
  if (s.reads) {
    leave_out_checks(results);
  }
  const int good = compare(s, 0, results, true);
  if (good < 5) {
    return name + (good == -2   ? ": the library branches on the state of this model"
                   : good == -1 ? ": what was traced differs from the library at another state"
                                : ": the library steps few states of this model");
  }
  t.made = R;
  for (std::size_t i = 0; i < results.size(); i++) {
    t.results.push_back({names[i], results[i]});
  }
  for (const entry &e : s.input) {
    t.names.push_back(e.name);
    t.given.push_back(bit_of_pointer(t.pointer, e.name));
  }
  return "";
}

/* Have functions a model of numbers as their first argument? */
static bool varies(const trace_choice *choice)
{
  return choice->vary != 0 || choice->table;
}

/* With the name of the model for @, its type of numbers for $ and their suffix for '; where numbers of it vary, % is the
   first argument, ^ what is given for it, # that it is missing. */
static std::string filled(const trace_choice *choice, const std::string &text)
{
  std::string s;
  for (char c : text) {
    s += c == '@'   ? std::string(choice->name)
         : c == '$' ? std::string(choice->single ? "float" : "double")
         : c == '%' ? std::string(!varies(choice) ? "" : "const ") + (!varies(choice) ? "" : choice->name) +
                          (!varies(choice) ? ""
                           : choice->wide  ? "_wide_model *model, "
                                           : "_model *model, ")
         : c == '^'  ? std::string(varies(choice) ? "model, " : "")
         : c == '#'  ? std::string(varies(choice) ? " || !model" : "")
         : c == '\'' ? std::string(choice->single ? "f" : "")
                     : std::string(1, c);
  }
  return s;
}

/* What is checked and set before the functions' own text. */
static const char refused_null[] = "#) {\n    return @_null;\n  }\n",
                  no_input[] = "  static @_input none; /* all zero */\n",
                  step_arguments[] =
                      "(%@_state *state, const @_input *start, const @_input *middle, const @_input *end, $ dt)",
                  step_inputs[] = "  start = start ? start : &none;\n  middle = middle ? middle : &none;\n"
                                  "  end = end ? end : &none;\n  (void)start, (void)middle, (void)end;\n",
                  sdirk_arguments[] = "(@_state *state, const @_input *start, const @_input *end, $ dt)",
                  sdirk_inputs[] = "  if (!state || (start != NULL) != (end != NULL)) {\n    return @_null;\n  }\n"
                                   "  start = start ? start : &none;\n  end = end ? end : &none;\n"
                                   "  (void)start, (void)end;\n",
                  wide_step[] =
                      "static @_status @_wide_step(%@_wide_state *state, const @_wide_input *start, const @_wide_input "
                      "*middle,\n                              const @_wide_input *end, $ length)",
                  wide_sdirk[] = "static @_status @_wide_step(%@_wide_state *state, const @_wide_input *start, const "
                                 "@_wide_input *end,\n                              $ length)",
                  wide_inputs[] =
                      "  static const @_wide_input none; /* all zero */\n  const @_wide dt = @_wide_all(length);\n"
                      "  @_wide_mask good = dt > 0.0';\n",
                  refused_state[] = "  if (!@_is_finite(state)) {\n    return @_not_finite;\n  }\n",
                  one_input[] = "  in = in ? in : &none;\n  (void)in;\n";

/* All functions of a file: kernels that they have in common are written once. */
struct file_of_functions {
  const trace_choice *choice;
  writer w;
  std::vector<traced> all;
  std::set<std::string> taken; /* names of kernels */
  std::set<std::uint64_t> written, placed;

  file_of_functions(FILE *out, const trace_choice *of) : choice(of)
  {
    late.clear();
    w.out = out;
    w.name = of->name;
    w.wide = of->wide != 0;
    w.real = w.wide ? w.name + "_wide" : of->single ? "float" : "double";
    w.single = of->single;
    w.varies = varies(of);
    w.settled = true;
    w.only_if["fbi_drives_check"] = "start != end"; /* an input that is held tells nothing of its rates */
    w.status = [this](int s) { return status_name(w.name, s); };
  }

  /* Traces a function; "", or why it cannot be written. before: the results, text for `filled`. */
  std::string add(subject &s, const std::string &head, const std::string &before, const std::string &after)
  {
    traced t;
    const std::string declared = filled(choice, head);
    const std::size_t end = declared.find('('), start = declared.rfind(' ', end) + 1;
    const std::string why = trace_function(t, s, declared.substr(start, end - start));
    t.head = declared;
    t.before = filled(choice, before);
    t.after = after + (w.varies ? "  (void)model;\n" : "");
    all.push_back(t);
    return why;
  }

  /* What makes a model of factors; "", or why it cannot be written. */
  std::string add_scaling(subject &s)
  {
    return add(s,
               "static @_status @_numbers(@_model *model, $ stiffness, $ damping, $ mass, $ hub_mass, $ hub_inertia)",
               "", "  (void)stiffness, (void)damping, (void)mass, (void)hub_mass, (void)hub_inertia;\n");
  }

  /* The step of all lanes; "", or why it cannot be written. */
  std::string add_wide(subject &s)
  {
    const std::string inputs = std::string(wide_inputs) + (choice->implicit ? sdirk_inputs : step_inputs);
    return add(s, choice->implicit ? wide_sdirk : wide_step, inputs, "");
  }

  /* A function that is written beside the single step alone: which results of the kernels that both call it takes decides
     how their sums are factored, and a lane has the bits of the single step. */
  std::string add_beside(subject &s, const std::string &head)
  {
    const std::string why = add(s, head, "", "");
    all.back().beside = true;
    return why;
  }

  static std::string status_name(const std::string &name, int status)
  {
    static const struct {
      int status;
      const char *name;
    } names[] = {{FB_ERR_NULL, "_null"},
                 {FB_ERR_VALUE, "_value"},
                 {FB_ERR_NOT_FINITE, "_not_finite"},
                 {FB_ERR_RANGE, "_range"},
                 {FB_ERR_STEP, "_step_length"},
                 {FB_ERR_SINGULAR, "_singular"},
                 {BRANCH, "_range"},
                 {FB_ERR_UNDETERMINED, "_singular"},
                 {FB_ERR_CONTRADICTION, "_contradiction"},
                 {FB_ERR_CONVERGENCE, "_convergence"}};
    for (const auto &s : names) {
      if (s.status == status) {
        return name + s.name;
      }
    }
    return "(" + name + "_status)" + std::to_string(status);
  }

  /* The kernels that a graph calls, what it uses of them, and what of its own arguments it reads; true: more than was
     known. */
  bool collect(const graph &g, const std::vector<number> &results)
  {
    const std::vector<char> live = needed(g, results, true, &w.read);
    std::set<int> between; /* calls whose results the next turn of a loop takes */
    bool more = false;
    auto use = [&](const graph &inner, int result) {
      more = w.kernel[inner.kind].results.insert({result, 0}).second || more;
    };
    for (const auto &l : loops_of(g, live)) {
      const graph &inner = called_by(g, l.first);
      between.insert(l.second.calls.begin(), l.second.calls.end() - 1);
      for (const auto &c : l.second.carried) {
        if (w.read.count(inner.kind) && w.read[inner.kind][(std::size_t)c.first]) {
          w.carried[inner.kind][c.first] = c.second;
          use(inner, c.second);
        }
      }
    }
    for (std::size_t i = 1; i < g.nodes.size(); i++) {
      const node &n = g.nodes[i];
      if (live[i] && n.op == 'r' && !between.count(node_of(n.a)) && !called_by(g, node_of(n.a)).loops) {
        use(called_by(g, node_of(n.a)), (int)n.b.d);
      }
      if ((live[i] || !g.apart.empty()) && n.op == 'i' && g.parent >= 0) {
        std::vector<char> &read = w.read[g.kind];
        read.resize(g.arguments.size(), 0);
        more = more || !read[(std::size_t)n.a.d];
        read[(std::size_t)n.a.d] = 1;
      }
    }
    return more;
  }

  /* The same of all functions. */
  bool collect_all()
  {
    bool more = false;
    for (const traced &t : all) {
      R = t.made;
      for (const graph &g : R.all) {
        std::vector<number> results;
        for (const auto &r : t.results) {
          if (g.parent < 0) {
            results.push_back(r.second);
          }
        }
        if (g.loops) {
          continue;
        }
        for (const auto &r : w.kernel[g.kind].results) {
          if (g.parent >= 0) {
            results.push_back(number_of((int)(&g - &R.all[0]), r.first));
          }
        }
        more = collect(g, results) || more;
      }
    }
    return more;
  }

  /* Places of the arguments and results of a kernel, after those that it calls: first what is carried. What these leave
     is not copied where most of it is a result of this one, too. */
  void place(const recording &made, int at)
  {
    const graph &g = made.all[(std::size_t)at];
    kernel_text &k = w.kernel[g.kind];
    const std::vector<char> &read = w.read[g.kind];
    const std::map<int, int> &carried = w.carried[g.kind];
    std::map<int, int> taken_of; /* results by call */
    if (g.loops || !placed.insert(g.kind).second) {
      return;
    }
    for (const node &n : g.nodes) {
      if (n.op == 'k') {
        place(made, (int)n.a.d);
      }
    }
    for (const auto &c : carried) {
      k.arguments.push_back(c.first);
      k.carried.push_back(c.second);
    }
    for (int a = 0; a < (int)read.size(); a++) {
      if (read[(std::size_t)a] && !carried.count(a)) {
        k.arguments.push_back(a);
      }
    }
    k.n_result = (int)k.carried.size();
    auto call_of = [&](int r) {
      const node &n = g.nodes[(std::size_t)r];
      const graph *const called =
          n.op == 'r' ? &made.all[(std::size_t)g.nodes[(std::size_t)node_of(n.a)].a.d] : nullptr;
      return called && !called->loops && called->slots.empty() ? node_of(n.a) : 0;
    };
    std::map<std::pair<int, int>, int> row_size, row_start; /* of loops, by loop and node: its results stand in a row */
    for (int r : k.in_rows) {
      const node &n = g.nodes[(std::size_t)r];
      taken_of[call_of(r)]++;
      row_size[{node_of(n.a), (int)n.b.d}] += is_of_loop(made, g, n);
    }
    for (int r : k.in_rows) {
      const auto found = std::find(k.carried.begin(), k.carried.end(), r);
      const int call = call_of(r);
      const kernel_text *const of =
          call ? &w.kernel.at(made.all[(std::size_t)g.nodes[(std::size_t)call].a.d].kind) : nullptr;
      if (found != k.carried.end()) {
        k.results[r] = (int)(found - k.carried.begin());
      } else if (of && 2 * taken_of[call] > of->n_result) {
        if (k.inner.insert({call, k.n_result}).second) {
          k.n_result += of->n_result;
        }
        k.results[r] = k.inner[call] + of->results.at((int)g.nodes[(std::size_t)r].b.d);
      } else {
        const node &n = g.nodes[(std::size_t)r];
        const std::pair<int, int> row(node_of(n.a), (int)n.b.d);
        const int trips = is_of_loop(made, g, n) ? made.all[(std::size_t)g.nodes[(std::size_t)row.first].a.d].trips : 0;
        if (trips > 2 && 2 * row_size[row] > trips) {
          if (row_start.insert({row, k.n_result}).second) {
            k.n_result += trips;
          }
          k.results[r] = row_start[row] + (int)n.c.d;
        } else {
          k.results[r] = k.n_result++;
        }
      }
    }
  }

  static bool is_of_loop(const recording &made, const graph &g, const node &n)
  {
    return n.op == 'r' && made.all[(std::size_t)g.nodes[(std::size_t)node_of(n.a)].a.d].loops;
  }

  /* Results of a kernel, those of a loop one behind the other by iteration. */
  static std::vector<int> rows_of(const graph &g, const std::map<int, int> &results)
  {
    std::map<std::vector<int>, int> rows;
    std::vector<int> list;
    for (const auto &r : results) {
      const node &n = g.nodes[(std::size_t)r.first];
      const bool of_loop = n.op == 'r' && called_by(g, node_of(n.a)).loops;
      rows[of_loop ? std::vector<int>{node_of(n.a), (int)n.b.d, (int)n.c.d} : std::vector<int>{r.first}] = r.first;
    }
    for (const auto &r : rows) {
      list.push_back(r.second);
    }
    return list;
  }

  /* Is each call of a kernel that carries numbers a turn of a loop? */
  bool is_rolled(const traced &t) const
  {
    std::vector<number> results;
    std::set<int> turns;
    bool all_of_them = true;
    for (const auto &r : t.results) {
      results.push_back(r.second);
    }
    const graph &g = R.all[0];
    for (const auto &l : loops_of(g, needed(g, results, true, &w.read))) {
      turns.insert(l.second.calls.begin(), l.second.calls.end());
    }
    for (std::size_t i = 1; i < g.nodes.size(); i++) {
      all_of_them = all_of_them && (g.nodes[i].op != 'k' || called_by(g, (int)i).slots.empty() || turns.count((int)i));
    }
    return all_of_them;
  }

  /* In single precision one of two values is chosen by a table: the same instructions on processors that have no selection
     of floats. */
  void write_of_two() const
  {
    std::fputs(filled(choice, "static inline float @_of_two(int first, float a, float b)\n{\n"
                              "  const float both[2] = {b, a};\n  return both[first];\n}\n\n")
                   .c_str(),
               w.out);
  }

  /* What computes without a number that is none may not notice it. A state is numbers alone. */
  void write_finite() const
  {
    std::fputs(filled(choice, std::string("static int @_is_finite(const @_state *state)\n{\n"
                                          "  const $ *const x = (const $ *)state;\n  $ sum = 0;\n"
                                          "  for (size_t i = 0; i < sizeof *state / sizeof *x; i++) {\n    sum += ") +
                                  (w.single ? "fabsf" : "fabs") +
                                  "(x[i]);\n  }\n  return sum <= " + (w.single ? "1e18f" : "1e150") + ";\n}\n\n")
                   .c_str(),
               w.out);
  }

  /* Writes all functions; "", or why it cannot. With loops: their tables first. */
  std::string write()
  {
    FILE *const out = w.out, *text = nullptr;
    std::string why;
    late_results_stand();
    if (w.rarely.empty() || !(text = std::tmpfile())) {
      return write_functions();
    }
    w.out = text;
    why = write_functions();
    w.out = out;
    std::fprintf(
        out,
        "#if defined(__GNUC__) && !defined(__clang__) && __GNUC__ >= 9 /* else what follows many checks is "
        "taken to be rare */\n#define %s(x) __builtin_expect_with_probability((x), 0, 1.0)\n#else\n#define "
        "%s(x) (x)\n#endif\n#ifdef __GNUC__\n#define %s_RESTRICT __restrict\n#else\n#define %s_RESTRICT\n#endif\n"
        "#if defined(__clang__)\n#define %s_UNROLL _Pragma(\"unroll 8\")\n#elif defined(__GNUC__)\n#define %s_UNROLL "
        "_Pragma(\"GCC unroll 8\")\n#else\n#define %s_UNROLL\n#endif\n\n",
        w.rarely.c_str(), w.rarely.c_str(), w.name.c_str(), w.name.c_str(), w.name.c_str(), w.name.c_str(),
        w.name.c_str());
    for (const auto &t : w.tables) {
      std::string list;
      for (const std::string &x : t.first) {
        list += (list.empty() ? "" : ", ") + x;
      }
      w.indent = 0;
      w.line("static const " + std::string(number_type()) + " " + t.second + "[" + std::to_string(t.first.size()) +
             "] = {" + list + "};");
    }
    std::rewind(text);
    for (int c; (c = std::getc(text)) != EOF;) {
      std::putc(c, out);
    }
    std::fclose(text);
    return why;
  }

  /* All calls of a kernel have the results that any of them has; notes whether there are loops. */
  void late_results_stand()
  {
    for (traced &t : all) {
      R = t.made;
      for (std::size_t g = 1; g < R.all.size(); g++) {
        w.rarely = R.all[g].trips > 0 ? w.name + "_RARELY" : w.rarely;
        if (!R.all[g].loops && late.count(R.all[g].kind)) {
          settle((int)g, late[R.all[g].kind].size());
        }
      }
      t.made = R;
    }
  }

  /* Kernels, then the functions that call them. */
  std::string write_functions()
  {
    std::vector<std::pair<std::size_t, int>> order; /* of kernels: function, graph */
    std::size_t rows = 0;                           /* most of any */
    std::set<std::uint64_t> seen;
    while (collect_all()) {
    }
    for (const traced &t : all) {
      R = t.made;
      if (!is_rolled(t)) {
        return "the iterations of a step are not all alike";
      }
    }
    for (std::size_t f = 0; f < all.size(); f++) {
      R = all[f].made;
      find_quiet(w.quiet, all[f].given);
      for (std::size_t g = 0; g < R.all.size(); g++) {
        if (g > 0 && !R.all[g].loops && seen.insert(R.all[g].kind).second) {
          order.push_back({f, (int)g});
          kernel_text &k = w.kernel[R.all[g].kind];
          k.in_rows = rows_of(R.all[g], k.results);
          const std::string base = w.name + (w.wide ? "_wide_" : "_") +
                                   R.all[g].name.substr(R.all[g].name.compare(0, 4, "fbi_") == 0 ? 4 : 0);
          k.name = base;
          for (int number = 2; !taken.insert(k.name).second; number++) {
            k.name = base + "_" + std::to_string(number);
          }
        }
      }
    }
    for (const auto &k : order) {
      place(all[k.first].made, k.second);
    }
    if (!w.wide && w.single) {
      write_of_two();
    }
    if (!w.wide) {
      write_finite();
    }
    for (auto k = order.begin(); k != order.end(); k++) {
      rows = std::max(rows, all[k->first].made.all[(std::size_t)k->second].apart.size());
    }
    if (rows > 0) {
      std::fprintf(w.out, "%s", rows_functions(w.name, number_type(), w.single, (int)rows).c_str());
    }
    for (auto k = order.begin(); k != order.end(); k++) {
      if (!all[k->first].beside) {
        write_kernels(all[k->first].made, k->second);
      }
    }
    for (const traced &t : all) {
      if (t.beside) {
        continue;
      }
      R = t.made;
      w.names = t.names;
      w.pointer = t.pointer;
      w.given = t.given;
      std::fprintf(w.out, "%s\n{\n%s", t.head.c_str(), t.before.c_str());
      write_graph(0, t.results);
      std::fprintf(w.out, "%s  return %s_ok;\n}\n\n", t.after.c_str(), w.name.c_str());
    }
    return "";
  }

  /* A kernel after those that it calls, each once. */
  void write_kernels(const recording &made, int at)
  {
    const graph &g = made.all[(std::size_t)at];
    R = made;
    if ((!checks_anything(g) && w.kernel.at(g.kind).n_result == 0) || !written.insert(g.kind).second) {
      return; /* not called, or there already */
    }
    for (const node &n : g.nodes) {
      if (n.op == 'k') {
        write_kernels(made, (int)n.a.d);
      }
    }
    R = made;
    if (g.apart.empty()) {
      write_kernel(at);
    } else {
      write_rows(g);
    }
  }

  /* Of a lane. */
  const char *number_type() const
  {
    return choice->single ? "float" : "double";
  }

  /* Multipliers and angles of rows; a: lower triangle of Q, column, c. Of lanes one after the other: which of their rows
     are independent may differ. */
  void write_rows(const graph &g)
  {
    const kernel_text &k = w.kernel.at(g.kind);
    const std::string n = w.name, m = std::to_string(g.apart.size()), real = number_type(),
                      own = k.name + (w.wide ? "_of_lane" : "");
    std::string kinds;
    for (int kind : g.apart) {
      kinds += (kinds.empty() ? "" : ", ") + std::to_string(kind);
    }
    std::fprintf(
        w.out,
        "static %s_status %s(%s *r, const %s *a)\n{\n  static const int kind[%s] = {%s};\n  %s_work w;\n"
        "  w.n_row = %s;\n  for (int i = 0; i < %s; i++) {\n    w.kind[i] = kind[i];\n"
        "    for (int j = 0; j <= i; j++) {\n      w.Q[i * %s + j] = *a;\n      w.Q[j * %s + i] = *a++;\n    }\n  }\n"
        "  for (int i = 0; i < %s; i++) {\n    w.column[i] = a[i];\n    w.c[i] = a[%s + i];\n  }\n"
        "  %s_rows_apart(&w);\n",
        n.c_str(), own.c_str(), real.c_str(), real.c_str(), m.c_str(), kinds.c_str(), n.c_str(), m.c_str(), m.c_str(),
        m.c_str(), m.c_str(), m.c_str(), m.c_str(), n.c_str());
    for (const auto &r : k.results) {
      const int i = r.first - g.n_input - 1, rows_of = (int)g.apart.size();
      std::fprintf(w.out, "  r[%d] = w.%s[%d];\n", r.second, i < rows_of ? "mu" : "angle", i % rows_of);
    }
    std::fprintf(w.out, "  return %s_ok;\n}\n\n", n.c_str());
    if (w.wide) {
      const std::string model = varies(choice) ? "  (void)model;\n" : "";
      std::fprintf(w.out,
                   "static void %s(%s%s *r, const %s *a, %s_wide_mask *held)\n{\n"
                   "  for (int lane = 0; lane < %s_LANES; lane++) {\n    %s x[%d], y[%d];\n"
                   "    for (int i = 0; i < %d; i++) {\n      x[i] = a[i][lane];\n    }\n"
                   "    (void)%s(y, x);\n"
                   "    for (int i = 0; i < %d; i++) {\n      r[i][lane] = y[i];\n    }\n  }\n  (void)held;\n%s}\n\n",
                   k.name.c_str(), filled(choice, "%").c_str(), w.real.c_str(), w.real.c_str(), n.c_str(), n.c_str(),
                   real.c_str(), g.n_input, k.n_result, g.n_input, own.c_str(), k.n_result, model.c_str());
    }
  }

  void write_graph(int at, std::vector<std::pair<std::string, number>> results)
  {
    std::vector<number> of_results;
    for (const auto &r : results) {
      of_results.push_back(r.second);
    }
    if (!has_loops(R.all[(std::size_t)at])) {
      factor(at, of_results, w.read);
    }
    for (std::size_t i = 0; i < results.size(); i++) {
      results[i].second = of_results[i];
    }
    w.body(R.all[(std::size_t)at], results);
  }

  void write_kernel(int at)
  {
    const graph &g = R.all[(std::size_t)at];
    const kernel_text &k = w.kernel.at(g.kind);
    std::vector<std::pair<std::string, number>> results;
    for (std::size_t i = 0; i < k.carried.size(); i++) {
      results.push_back({"r[" + std::to_string(i) + "]", number_of(at, k.carried[i])});
    }
    for (const auto &r : k.results) {
      if (r.second >= (int)k.carried.size()) {
        results.push_back({"r[" + std::to_string(r.second) + "]", number_of(at, r.first)});
      }
    }
    w.names.assign((std::size_t)g.n_input, "");
    for (std::size_t i = 0; i < k.arguments.size(); i++) {
      w.names[(std::size_t)k.arguments[i]] = "a[" + std::to_string(i) + "]";
    }
    const quiet_kernel &quiet = w.quiet.at(g.kind);
    w.pointer = {"acts"};
    w.given.clear();
    for (int i = 0; i < g.n_input; i++) {
      w.given.push_back(quiet.argument[(std::size_t)i] ? 1u : 0u);
    }
    const char *const n = w.name.c_str(), *const real = w.real.c_str(),
                      *const acts = quiet.node.empty() ? "" : ", int acts";
    const std::string first = filled(choice, "%"), unused = w.varies ? ", (void)model" : "";
    if (w.wide) {
      std::fprintf(
          w.out,
          "/* %s */\nstatic void %s(%s%s *r, const %s *a, %s_wide_mask *held%s)\n{\n  %s_wide_mask good = *held;\n",
          g.name.c_str(), k.name.c_str(), first.c_str(), real, real, n, acts, n);
    } else {
      const std::string apart = w.rarely.empty() ? "" : w.name + "_RESTRICT "; /* no array is the other one */
      std::fprintf(w.out, "/* %s */\nstatic %s_status %s(%s%s *%sr, const %s *%sa%s)\n{\n", g.name.c_str(), n,
                   k.name.c_str(), first.c_str(), real, apart.c_str(), real, apart.c_str(), acts);
    }
    w.of_kernel = &k;
    write_graph(at, results);
    w.of_kernel = nullptr;
    std::fprintf(w.out, "  (void)r, (void)a%s%s;\n", unused.c_str(), *acts ? ", (void)acts" : "");
    std::fprintf(w.out, w.wide ? "  *held = good;\n}\n\n" : "  return %s_ok;\n}\n\n", n);
  }
};

} // namespace trace
#endif
