/* text.h - a graph as C99: one statement for what is used more than once or would be too long, in the order of the library;
   the rest stands where it is used. */
#ifndef TRACE_TEXT_H
#define TRACE_TEXT_H
#include "given.h"
#include "join.h"
#include "loops.h"
#include <cstdio>
#include <functional>

namespace trace
{

enum { LONGEST = 100 }; /* characters of an expression in another */
enum { TURNS = 2 };     /* of a loop that is traced, or more by a number that is always the same */

/* A kernel as a function of what is written. */
struct kernel_text {
  std::string name;
  std::map<int, int> results; /* nodes that a caller uses, and where they stand among the results */
  std::vector<int> arguments; /* that it reads, in their order: those from which all turns of a loop begin first */
  std::vector<int> carried;   /* so: nodes that the next turn takes in their place */
  std::vector<int> in_rows;   /* the results in their order */
  std::map<int, int> inner;   /* calls whose results are results of it: where they begin */

  int n_result = 0;
};

struct writer;
static void write_loop(writer &w, int i); /* a loop, node i of w's graph */
static void place_spans(writer &w);

struct writer {
  FILE *out;
  std::string name, real; /* of the model: prefix of all names; its type of numbers */
  bool single;
  bool varies = false; /* functions are given a model of numbers */
  bool wide =
      false; /* numbers are vectors, one lane for each copy of a model: what is checked of them is kept in one mask, `good` */
  std::string rarely;                          /* a macro, for the condition of a check */
  std::function<std::string(int)> status;      /* its name */
  std::vector<std::string> names;              /* of the inputs */
  std::map<std::uint64_t, kernel_text> kernel; /* by their kind */
  std::vector<std::string> pointer;            /* of inputs that may not be given: what is true where they are */
  std::vector<unsigned> given;                 /* by input, bits of these */
  quiet_kernels quiet;
  std::map<std::string, std::string> only_if; /* kernels that a condition on pointers belongs to */
  read_arguments read;
  std::map<std::uint64_t, std::map<int, int>>
      carried;          /* by the kind of a kernel: arguments, and what the next turn takes */
  std::string turns;    /* of a loop of TURNS that were traced: how many there are */
  std::string judged;   /* the kernel that is called where the loop before it has more than one turn */
  bool settled = false; /* all results are known before the first is written: it may stand where an input does */
  const graph *of_graph, *spans_of;
  std::vector<int> uses;
  std::map<int, loop> loops;     /* of calls of a kernel, by the first */
  std::set<int> between;         /* those of which further turns follow */
  std::string last_loop;         /* how many turns it has */
  std::vector<std::string> text; /* of each node, once it is known */
  std::vector<unsigned> zero;    /* inputs without which it is zero */
  std::vector<char> outlasts;    /* 1: of a block of what is given, and used outside */
  std::vector<char> live;        /* nodes of the graph that are needed */
  int n_temporary, n_call, n_loop, indent = 2;
  std::map<std::vector<std::string>, std::string> tables; /* names of lists of constants, in all functions */
  const kernel_text *of_kernel = nullptr;                 /* that is written: results of its loops go to r at once */
  std::set<std::vector<std::string>> constant_spans;
  std::map<int, std::vector<std::pair<std::string, int>>> places; /* of nodes in spans */

  std::string constant(double x) const
  {
    char s[40];
    std::snprintf(s, sizeof s, single ? "%.9g" : "%.17g", x);
    if (!std::strpbrk(s, ".en")) {
      std::strcat(s, ".0");
    }
    if (single && std::fabs(x) > 1e30) { /* FB_HUGE and its square: not in single precision */
      std::strcpy(s, x < 0 ? "-3e38" : "3e38");
    }
    return (s[0] == '-' ? "(" : "") + std::string(s) + (single ? "f" : "") + (s[0] == '-' ? ")" : "");
  }

  std::string of(number a) const
  {
    return node_of(a) ? text[(std::size_t)node_of(a)] : constant(a.d);
  }

  /* What stands alone; a constant is one of all lanes. */
  std::string alone(number a) const
  {
    return wide && !node_of(a) ? name + "_wide_all(" + constant(a.d) + ")" : of(a);
  }

  std::string call(const char *function, number a) const
  {
    return wide ? name + "_wide_" + function + "(" + alone(a) + ")"
                : std::string(function) + (single ? "f(" : "(") + of(a) + ")";
  }

  /* One of two values. */
  std::string choice(const node &n) const
  {
    auto is_zero = [](number a) { return !node_of(a) && bits(a) == 0; };
    if (!wide && single) { /* a branch where the processor has no selection of floats */
      return name + "_of_two(" + of(n.a) + ", " + of(n.b) + ", " + of(n.c) + ")";
    }
    if (!wide) {
      return of(n.a) + " ? " + of(n.b) + " : " + of(n.c);
    }
    return is_zero(n.c)   ? name + "_wide_where(" + of(n.a) + ", " + alone(n.b) + ")"
           : is_zero(n.b) ? name + "_wide_where(~" + of(n.a) + ", " + alone(n.c) + ")"
                          : name + "_wide_either(" + of(n.a) + ", " + alone(n.b) + ", " + alone(n.c) + ")";
  }

  std::string comparison(char relation, number a, number b) const
  {
    return of(a) + (relation == '<' ? " < " : relation == 'l' ? " <= " : " == ") + of(b);
  }

  std::string expression(const node &n) const
  {
    switch (n.op) {
    case 'n':
      return "-" + of(n.a);
    case 'q':
      return call("sqrt", n.a);
    case 's':
      return call("sin", n.a);
    case 'c':
      return call("cos", n.a);
    case 'f':
      return call(wide ? "abs" : "fabs", n.a);
    case 'e':
      return call("exp", n.a);
    case 'z':
      return wide ? call("trunc", n.a) : "(" + real + ")(int)(" + of(n.a) + ")";
    case 't':
      return (wide     ? name + "_wide_atan2("
              : single ? std::string("atan2f(")
                       : std::string("atan2(")) +
             alone(n.a) + ", " + alone(n.b) + ")";
    case '<':
    case 'l':
    case '=':
      return comparison(n.op, n.a, n.b);
    case '?':
      return choice(n);
    default:
      return of(n.a) + " " + n.op + " " + of(n.b);
    }
  }

  void line(const std::string &s) const
  {
    std::size_t at = 0, column = (std::size_t)indent;
    while (s.size() - at > 118 - column) { /* break behind a space */
      std::size_t end = s.rfind(' ', at + 118 - column);
      end = end == std::string::npos || end <= at ? s.find(' ', at) : end;
      if (end == std::string::npos) {
        break;
      }
      std::fprintf(out, "%*s%s\n", (int)column, "", s.substr(at, end - at).c_str());
      at = end + 1;
      column = (std::size_t)indent + (s.compare(0, 2, "  ") == 0 ? 6 : 4);
    }
    std::fprintf(out, "%*s%s\n", (int)column, "", s.substr(at).c_str());
  }

  std::string temporary()
  {
    return "t" + std::to_string(n_temporary++);
  }

  /* Any of these inputs is given. */
  std::string any_given(unsigned bits) const
  {
    std::string s;
    for (std::size_t i = 0; i < pointer.size(); i++) {
      s += bits >> i & 1u ? (s.empty() ? "" : " || ") + pointer[i] : "";
    }
    return s;
  }

  /* Whether a kernel computes what acts: what it has for sure to be told. */
  std::string acts(const graph &inner) const
  {
    const auto found = quiet.find(inner.kind);
    if (found == quiet.end() || found->second.node.empty()) {
      return "";
    }
    for (std::size_t i = 0; i < inner.arguments.size(); i++) {
      const number a = inner.arguments[i];
      if (found->second.argument[i] && !zero[(std::size_t)node_of(a)] && !is(a, 0.0)) {
        return ", 1";
      }
    }
    const std::string s = any_given(inputs_of_call(inner, quiet, zero));
    return ", " + (s.empty() ? "0" : s);
  }

  /* Does a text stand `by` places behind another one in an array? */
  static bool follows(const std::string &first, const std::string &text, int by)
  {
    const std::size_t open = first.rfind('[');
    return open != std::string::npos && first.back() == ']' && first.find_first_of(" (") == std::string::npos &&
           text == first.substr(0, open + 1) + std::to_string(std::atoi(first.c_str() + open + 1) + by) + "]";
  }

  /* The call of a kernel, or a loop of calls, whose results stand in r1, r2, .. */
  void call_kernel(int i)
  {
    const graph &inner = R.all[(std::size_t)of_graph->nodes[(std::size_t)i].a.d];
    const kernel_text &k = kernel.at(inner.kind);
    const auto turns_of = loops.find(i);
    const bool turning = turns_of != loops.end();
    const bool passed = of_kernel && of_kernel->inner.count(i);
    const std::string index = std::to_string(n_call++), taken = "a" + index, in = turning ? "    " : "  ",
                      results = passed ? "r + " + std::to_string(of_kernel->inner.at(i)) : "r" + index;
    std::string arguments, in_row; /* as they are; where they stand one behind the other */
    for (const int &a : k.arguments) {
      const std::string own = alone(inner.arguments[(std::size_t)a]);
      const int at = (int)(&a - &k.arguments[0]);
      in_row = at == 0 ? own : in_row;
      in_row = follows(in_row, own, at) ? in_row : "";
      arguments += (arguments.empty() ? "" : ", ") + own;
    }
    const bool copied = turning || in_row.empty() || wide;
    const auto condition = only_if.find(inner.name);
    text[(std::size_t)i] = results;
    if (!passed) {
      line(real + " " + results + "[" + std::to_string(k.n_result > 0 ? k.n_result : 1) + "];");
    }
    line(condition != only_if.end()                   ? "if (" + condition->second + ") {"
         : inner.name == judged && !last_loop.empty() ? "if (" + last_loop + " > 1) {"
                                                      : "{");
    if (!arguments.empty() && copied) {
      line((turning ? "  " : "  const ") + real + " " + taken + "[" + std::to_string(k.arguments.size()) + "] = {" +
           arguments + "};");
    }
    if (turning) {
      const int more = (int)turns_of->second.calls.size() - TURNS;
      last_loop = turns + (more > 0 ? " + " + std::to_string(more) : "");
      between.insert(turns_of->second.calls.begin(), turns_of->second.calls.end() - 1);
      for (int call : turns_of->second.calls) {
        text[(std::size_t)call] = results;
      }
      line("  for (int j = 0; j < " + last_loop + "; j++) {");
    }
    const std::string call = k.name + "(" + (varies ? "model, " : "") + results + ", " +
                             (arguments.empty() ? "NULL"
                              : copied          ? taken
                                                : "&" + in_row) +
                             (wide ? ", &good" : "") + acts(inner) + ");";
    if (wide) {
      line(in + call);
    } else {
      line(in + "const " + name + "_status status = " + call);
      line(in + "if (status != " + name + "_ok) {");
      line(in + "  return status;");
      line(in + "}");
    }
    if (turning) {
      line("    memcpy(" + taken + ", " + results + ", " + std::to_string(k.carried.size()) + " * sizeof *" + taken +
           ");");
      line("  }");
    }
    line("}");
  }

  static std::string element(const std::pair<std::string, int> &of)
  {
    return of.first + "[" + std::to_string(of.second) + "]";
  }

  /* Node i, whose text is known, to its places in spans from number `first` on: that is its text then. */
  void put(int i, std::size_t first)
  {
    const auto at = places.find(i);
    for (std::size_t k = first; at != places.end() && k < at->second.size(); k++) {
      line(element(at->second[k]) + " = " + text[(std::size_t)i] + ";");
    }
    if (at != places.end() && first == 0) {
      text[(std::size_t)i] = element(at->second[0]);
    }
  }

  /* The name of a list of constants. */
  std::string table(const std::vector<std::string> &list)
  {
    std::string &own = tables[list];
    own = own.empty() ? name + (wide ? "_wide_table_" : "_table_") + std::to_string(tables.size()) : own;
    return own;
  }

  /* The largest eigenvalue of a pair of matrices. */
  std::string largest(const std::vector<number> &list)
  {
    const std::string own = temporary();
    std::string numbers;
    for (std::size_t i = 0; i < list.size(); i++) {
      numbers += (i ? ", " : "") + of(list[i]);
    }
    line("const " + real + " pair_" + own + "[" + std::to_string(list.size()) + "] = {" + numbers + "};");
    line("const " + real + " " + own + " = " + name + "_largest(pair_" + own + ");");
    return own;
  }

  /* Node i as a statement, or as text for where it is used. */
  void statement(int i)
  {
    write_statement(i);
    if (of_graph->nodes[(std::size_t)i].op != 'l' && !places.empty() && spans_of == of_graph &&
        !is_of_loop(of_graph->nodes[(std::size_t)i])) {
      put(i, 0);
    }
  }

  bool is_of_loop(const node &n) const
  {
    return n.op == 'r' && of_graph->nodes[(std::size_t)node_of(n.a)].op == 'l';
  }

  void write_statement(int i)
  {
    const node &n = of_graph->nodes[(std::size_t)i];
    std::string s;
    if (n.op == 'i') {
      text[(std::size_t)i] = names[(std::size_t)n.a.d];
      return;
    }
    if (n.op == 'm') {
      text[(std::size_t)i] = "model->k[" + std::to_string((int)n.a.d) + (wide ? "].v" : "]");
      return;
    }
    if (n.op == 'v') {
      text[(std::size_t)i] = largest(of_graph->lists[(std::size_t)n.a.d]);
      return;
    }
    if (n.op == 'k') {
      if (text[(std::size_t)i].empty()) { /* else a further turn of a loop */
        call_kernel(i);
      }
      return;
    }
    if (n.op == 'l') {
      write_loop(*this, i);
      return;
    }
    if (n.op == 'r' && !text[(std::size_t)i].empty()) { /* a loop's */
      return;
    }
    if (n.op == 'r') {
      const graph &inner = R.all[(std::size_t)of_graph->nodes[(std::size_t)node_of(n.a)].a.d];
      if (between.count(node_of(n.a))) { /* is nothing that has a name */
        return;
      }
      const int at = kernel.at(inner.kind).results.at((int)n.b.d);
      text[(std::size_t)i] = of_kernel && of_kernel->inner.count(node_of(n.a))
                                 ? element({"r", of_kernel->inner.at(node_of(n.a)) + at})
                                 : element({of(n.a), at});
      return;
    }
    s = expression(n);
    const bool plain = std::strchr(wide ? "qscfetz?" : "qscfet", n.op) != nullptr;
    if (outlasts[(std::size_t)i]) {
      line(text[(std::size_t)i] + " = " + s + ";");
      return;
    }
    if (std::strchr("<l=", n.op) || (uses[(std::size_t)i] == 1 && s.size() < LONGEST)) {
      text[(std::size_t)i] = plain ? s : "(" + s + ")";
      return;
    }
    text[(std::size_t)i] = temporary();
    line("const " + real + " " + text[(std::size_t)i] + " = " + s + ";");
  }

  void check(const guard &c) const
  {
    const std::string s = comparison(c.relation, c.a, c.b);
    if (wide) {
      line("good &= " + std::string(c.outcome ? "" : "~") + "(" + s + ");" +
           (c.what.empty() ? "" : " /* " + c.what + " */"));
      return;
    }
    const std::string fails = (c.outcome ? "!(" : "") + s + (c.outcome ? ")" : "");
    line("if (" + (rarely.empty() ? fails : rarely + "(" + fails + ")") + ") {");
    if (settled && (c.status == BRANCH || c.status == FB_ERR_RANGE)) { /* what is no number has a status of its own */
      const std::string both = of(c.a) + " - " + of(c.b);
      line("  return " + both + " == " + both + " ? " + status(FB_ERR_RANGE) + " : " + status(FB_ERR_NOT_FINITE) + ";" +
           (c.what.empty() ? "" : " /* " + c.what + " */"));
      line("}");
      return;
    }
    line("  return " + status(c.status) + ";" + (c.what.empty() ? "" : " /* " + c.what + " */"));
    line("}");
  }

  void mark_outlasting(const std::vector<item> &items, const std::vector<number> &results)
  {
    const graph &g = *of_graph;
    std::vector<int> block(g.nodes.size(), 0);
    outlasts.assign(g.nodes.size(), 0);
    auto use = [&](number a, int at) {
      const int own = block[(std::size_t)node_of(a)];
      outlasts[(std::size_t)node_of(a)] |= own != 0 && own != at;
    };
    for (const item &now : items) {
      if (now.check) {
        use(g.guards[(std::size_t)now.at].a, now.block), use(g.guards[(std::size_t)now.at].b, now.block);
        continue;
      }
      const node &n = g.nodes[(std::size_t)now.at];
      block[(std::size_t)now.at] = now.block;
      if (is_call(n)) {
        for (number a : arguments_of(R.all[(std::size_t)n.a.d], live, &read)) {
          use(a, now.block);
        }
      }
      for (number a : operands(g, n)) {
        use(a, now.block);
      }
    }
    for (number r : results) {
      use(r, 0);
    }
  }

  void begin_block(const std::vector<item> &items, const item &first)
  {
    if (first.block == 0) {
      return;
    }
    for (const item &other : items) {
      if (other.block == first.block && !other.check && outlasts[(std::size_t)other.at]) {
        text[(std::size_t)other.at] = temporary();
        line(real + " " + text[(std::size_t)other.at] + " = {0};");
      }
    }
    line("if (" + any_given(first.bits) + ") {");
    indent += 2;
  }

  void end_block(int block)
  {
    if (block != 0) {
      indent -= 2;
      line("}");
    }
  }

  /* Results of a graph to `to`, with statements of all that they need. */
  void body(const graph &g, const std::vector<std::pair<std::string, number>> &results)
  {
    std::vector<number> of_results;
    for (const auto &r : results) {
      of_results.push_back(r.second);
    }
    live = needed(g, of_results, true, settled ? &read : nullptr);
    zero = zero_without(g, given, quiet);
    if (has_loops(g)) {
      joining{(int)(&g - &R.all[0]), live, zero}.join_all();
      live = needed(g, of_results, true, settled ? &read : nullptr);
    }
    of_graph = &g;
    loops = loops_of(g, live);
    between.clear();
    last_loop.clear();
    uses.assign(g.nodes.size(), 0);
    text.assign(g.nodes.size(), "");
    n_temporary = n_call = n_loop = 0;
    auto use = [&](number a) { uses[(std::size_t)node_of(a)]++; };
    for (std::size_t i = 1; i < live.size(); i++) {
      if (live[i] && is_call(g.nodes[i])) {
        const graph &called = R.all[(std::size_t)g.nodes[i].a.d];
        for (number a : arguments_of(called, live, &read)) {
          uses[(std::size_t)node_of(a)] += called.loops ? 2 : 1; /* a loop evaluates nothing again */
        }
      } else if (live[i]) {
        for (number a : operands(g, g.nodes[i])) {
          use(a);
        }
      }
    }
    for (number r : of_results) {
      use(r);
    }
    for (const guard &c : g.guards) {
      if (c.status != 0) {
        use(c.a), use(c.b);
      }
    }
    places.clear();
    for (std::size_t i = 1; of_kernel && i < g.nodes.size(); i++) {
      const auto at = of_kernel->results.find((int)i);
      if (live[i] && !zero[i] && at != of_kernel->results.end() && is_of_loop(g.nodes[i])) {
        places[(int)i].push_back({"r", at->second});
      }
    }
    spans_of = &g;
    if (has_loops(g)) {
      place_spans(*this);
    }
    const order_of_items order(g, live, zero);
    mark_outlasting(order.items, of_results);
    int block = 0;
    for (const item &now : order.items) {
      if (now.block != block) {
        end_block(block);
        begin_block(order.items, now);
        block = now.block;
      }
      if (now.check) {
        check(g.guards[(std::size_t)now.at]);
      } else {
        statement(now.at);
      }
    }
    end_block(block);
    for (number r : of_results) {
      std::string &own = text[(std::size_t)node_of(r)];
      if (settled && node_of(r) && own[0] != 't' && own[0] != 'r') {
        const std::string known = temporary();
        line("const " + real + " " + known + " = " + own + ";");
        own = known;
      }
    }
    if (wide && &g == &R.all[0]) { /* a state that is refused stays */
      line("if (!" + name + "_wide_every(good)) {");
      line("  return " + status(FB_ERR_RANGE) + ";");
      line("}");
    }
    for (const auto &r : results) {
      if (r.first != of(r.second)) {
        line(r.first + " = " + alone(r.second) + ";");
      }
    }
  }
};

} // namespace trace
#endif
