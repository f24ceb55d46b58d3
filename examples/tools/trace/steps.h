/* steps.h - functions of the library as C functions of a file: each is traced, and kernels that they have in common are written
   once. */
#ifndef TRACE_STEPS_H
#define TRACE_STEPS_H
#include "apart.h"
#include "factor.h"
#include "replay.h"
#include "text.h"
#include "trace.h"
#include <memory>

namespace trace
{

/* A traced function, with what stands around it in the text. */
struct traced {
  std::string head, before, after; /* before: the results */
  recording made;
  std::vector<std::pair<std::string, number>> results;
  std::vector<std::string> names; /* of the inputs */
  std::vector<std::string> pointer; /* to inputs that may not be given */
  std::vector<unsigned> given;      /* by input, bits of these */
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

/* A check that nothing is beyond the largest number, of numbers that nothing else needs. */
static void leave_out_checks(const std::vector<number> &results)
{
  graph &g = R.all[0];
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
  status = run(s, 0, -1, results, &names, true);
  if (status != FB_OK) {
    return name + ": " + refused_by(status);
  }
  if (R.conversions > 0) {
    return name + ": the library rounds a number of this model to a whole one";
  }
  judge_guards(s, 0, results, true);
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

/* With the name of the model for @ and its type of numbers for $. */
static std::string filled(const trace_choice *choice, const std::string &text)
{
  std::string s;
  for (char c : text) {
    s += c == '@' ? std::string(choice->name) : c == '$' ? choice->single ? "float" : "double" : std::string(1, c);
  }
  return s;
}

/* All functions of a file: kernels that they have in common are written once. */
struct file_of_functions {
  const trace_choice *choice;
  writer w;
  std::vector<traced> all;
  std::set<std::string> taken; /* names of kernels */
  std::set<std::uint64_t> written;

  file_of_functions(FILE *out, const trace_choice *of) : choice(of)
  {
    w.out = out;
    w.name = of->name;
    w.real = of->single ? "float" : "double";
    w.single = of->single;
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
    t.after = after;
    all.push_back(t);
    return why;
  }

  static std::string status_name(const std::string &name, int status)
  {
    static const struct {
      int status;
      const char *name;
    } names[] = {
        {FB_ERR_NULL, "_null"},   {FB_ERR_VALUE, "_value"},           {FB_ERR_NOT_FINITE, "_not_finite"},
        {FB_ERR_RANGE, "_range"}, {FB_ERR_STEP, "_step_length"},      {FB_ERR_SINGULAR, "_singular"},
        {BRANCH, "_range"},       {FB_ERR_UNDETERMINED, "_singular"}, {FB_ERR_CONTRADICTION, "_contradiction"}};
    for (const auto &s : names) {
      if (s.status == status) {
        return name + s.name;
      }
    }
    return "(" + name + "_status)" + std::to_string(status);
  }

  /* The kernels that a function calls, and what it uses of them. */
  void collect(const recording &r, int graph_at, const std::vector<char> &live)
  {
    const graph &g = r.all[(std::size_t)graph_at];
    for (std::size_t i = 1; i < g.nodes.size(); i++) {
      if (!live[i] || g.nodes[i].op != 'r') {
        continue;
      }
      const graph &inner = r.all[(std::size_t)g.nodes[(std::size_t)node_of(g.nodes[i].a)].a.d];
      w.kernel[inner.kind].results[(int)g.nodes[i].b.d] = 0;
    }
  }

  /* Calls `what` with the recordings of all functions and each graph in them. */
  void write()
  {
    std::vector<std::pair<std::size_t, int>> order; /* of kernels: function, graph */
    std::size_t rows = 0;                           /* most of any */
    std::set<std::uint64_t> seen;
    for (std::size_t f = 0; f < all.size(); f++) {
      R = all[f].made;
      find_quiet(w.quiet, all[f].given);
      std::vector<number> results;
      for (const auto &r : all[f].results) {
        results.push_back(r.second);
      }
      for (std::size_t g = 0; g < R.all.size(); g++) {
        collect(R, (int)g, g == 0 ? needed(R.all[0], results, true) : std::vector<char>(R.all[g].nodes.size(), 1));
        if (g > 0 && seen.insert(R.all[g].kind).second) {
          order.push_back({f, (int)g});
          kernel_text &k = w.kernel[R.all[g].kind];
          const std::string base =
              w.name + "_" + R.all[g].name.substr(R.all[g].name.compare(0, 4, "fbi_") == 0 ? 4 : 0);
          k.name = base;
          for (int number = 2; !taken.insert(k.name).second; number++) {
            k.name = base + "_" + std::to_string(number);
          }
        }
      }
    }
    for (auto &k : w.kernel) {
      int place = 0;
      for (auto &r : k.second.results) {
        r.second = place++;
      }
    }
    for (auto k = order.begin(); k != order.end(); k++) {
      rows = std::max(rows, all[k->first].made.all[(std::size_t)k->second].apart.size());
    }
    if (rows > 0) {
      std::fprintf(w.out, "%s", rows_functions(w.name, w.real, w.single, (int)rows).c_str());
    }
    for (auto k = order.begin(); k != order.end(); k++) {
      write_kernels(all[k->first].made, k->second);
    }
    for (const traced &t : all) {
      R = t.made;
      w.names = t.names;
      w.pointer = t.pointer;
      w.given = t.given;
      std::fprintf(w.out, "%s\n{\n%s", t.head.c_str(), t.before.c_str());
      write_graph(0, t.results);
      std::fprintf(w.out, "%s  return %s_ok;\n}\n\n", t.after.c_str(), w.name.c_str());
    }
  }

  /* A kernel after those that it calls, each once. */
  void write_kernels(const recording &made, int at)
  {
    const graph &g = made.all[(std::size_t)at];
    if (!written.insert(g.kind).second) {
      return;
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

  /* Multipliers and angles of rows; a: lower triangle of Q, column, c. */
  void write_rows(const graph &g)
  {
    const kernel_text &k = w.kernel.at(g.kind);
    const std::string n = w.name, m = std::to_string(g.apart.size());
    std::string kinds;
    for (int kind : g.apart) {
      kinds += (kinds.empty() ? "" : ", ") + std::to_string(kind);
    }
    std::fprintf(w.out,
                 "static %s_status %s(%s *r, const %s *a)\n{\n  static const int kind[%s] = {%s};\n  %s_work w;\n"
                 "  w.n_row = %s;\n  for (int i = 0; i < %s; i++) {\n    w.kind[i] = kind[i];\n"
                 "    for (int j = 0; j <= i; j++) {\n      w.Q[i * %s + j] = w.Q[j * %s + i] = *a++;\n    }\n  }\n"
                 "  for (int i = 0; i < %s; i++) {\n    w.column[i] = a[i];\n    w.c[i] = a[%s + i];\n  }\n"
                 "  %s_rows_apart(&w);\n",
                 n.c_str(), k.name.c_str(), w.real.c_str(), w.real.c_str(), m.c_str(), kinds.c_str(), n.c_str(),
                 m.c_str(), m.c_str(), m.c_str(), m.c_str(), m.c_str(), m.c_str(), n.c_str());
    for (const auto &r : k.results) {
      const int i = r.first - g.n_input - 1, rows_of = (int)g.apart.size();
      std::fprintf(w.out, "  r[%d] = w.%s[%d];\n", r.second, i < rows_of ? "mu" : "angle", i % rows_of);
    }
    std::fprintf(w.out, "  return %s_ok;\n}\n\n", n.c_str());
  }

  void write_graph(int at, std::vector<std::pair<std::string, number>> results)
  {
    std::vector<number> of_results;
    for (const auto &r : results) {
      of_results.push_back(r.second);
    }
    factor(at, of_results);
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
    for (const auto &r : k.results) {
      results.push_back({"r[" + std::to_string(r.second) + "]", number_of(at, r.first)});
    }
    const quiet_kernel &quiet = w.quiet.at(g.kind);
    w.names.clear();
    w.given.clear();
    w.pointer = {"acts"};
    for (int i = 0; i < g.n_input; i++) {
      w.names.push_back("a[" + std::to_string(i) + "]");
      w.given.push_back(quiet.argument[(std::size_t)i] ? 1u : 0u);
    }
    std::fprintf(w.out, "/* %s */\nstatic %s_status %s(%s *r, const %s *a%s)\n{\n", g.name.c_str(), w.name.c_str(),
                 k.name.c_str(), w.real.c_str(), w.real.c_str(), quiet.node.empty() ? "" : ", int acts");
    write_graph(at, results);
    std::fprintf(w.out, "  (void)r, (void)a%s;\n  return %s_ok;\n}\n\n", quiet.node.empty() ? "" : ", (void)acts",
                 w.name.c_str());
  }
};

/* What is checked and set before the functions' own text. */
static const char refused_null[] = ") {\n    return @_null;\n  }\n",
                  no_input[] = "  static @_input none; /* all zero */\n",
                  step_arguments[] =
                      "(@_state *state, const @_input *start, const @_input *middle, const @_input *end, $ dt)",
                  step_inputs[] = "  start = start ? start : &none;\n  middle = middle ? middle : &none;\n"
                                  "  end = end ? end : &none;\n  (void)start, (void)middle, (void)end;\n",
                  one_input[] = "  in = in ? in : &none;\n  (void)in;\n";

} // namespace trace
#endif
