/* text.h - a graph as C99: one statement for what is used more than once or would be too long, in the order of the library;
   the rest stands where it is used. */
#ifndef TRACE_TEXT_H
#define TRACE_TEXT_H
#include "graph.h"
#include <cstdio>
#include <functional>

namespace trace
{

enum { LONGEST = 100 }; /* characters of an expression in another */

/* A kernel as a function of what is written. */
struct kernel_text {
  std::string name;
  int graph;                  /* one of its calls */
  std::map<int, int> results; /* nodes that a caller uses, and where they stand among the results */
};

struct writer {
  FILE *out;
  std::string name, real; /* of the model: prefix of all names; its type of numbers */
  bool single;
  std::function<std::string(int)> status;      /* its name */
  std::vector<std::string> names;              /* of the inputs */
  std::map<std::uint64_t, kernel_text> kernel; /* by their kind */
  bool settled = false; /* all results are known before the first is written: it may stand where an input does */
  const graph *of_graph;
  std::vector<int> uses;
  std::vector<std::string> text; /* of each node, once it is known */
  int n_temporary, n_call;

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

  std::string call(const char *function, number a) const
  {
    return std::string(function) + (single ? "f(" : "(") + of(a) + ")";
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
      return call("fabs", n.a);
    case 'e':
      return call("exp", n.a);
    case 'z':
      return "(" + real + ")(int)(" + of(n.a) + ")";
    case 't':
      return std::string(single ? "atan2f(" : "atan2(") + of(n.a) + ", " + of(n.b) + ")";
    case '<':
    case 'l':
    case '=':
      return comparison(n.op, n.a, n.b);
    case '?':
      return of(n.a) + " ? " + of(n.b) + " : " + of(n.c);
    default:
      return of(n.a) + " " + n.op + " " + of(n.b);
    }
  }

  void line(const std::string &s) const
  {
    std::size_t at = 0, indent = 2;
    while (s.size() - at > 118 - indent) { /* break behind a space */
      std::size_t end = s.rfind(' ', at + 118 - indent);
      end = end == std::string::npos || end <= at ? s.find(' ', at) : end;
      if (end == std::string::npos) {
        break;
      }
      std::fprintf(out, "%*s%s\n", (int)indent, "", s.substr(at, end - at).c_str());
      at = end + 1;
      indent = s.compare(0, 2, "  ") == 0 ? 8 : 6;
    }
    std::fprintf(out, "%*s%s\n", (int)indent, "", s.substr(at).c_str());
  }

  std::string temporary()
  {
    return "t" + std::to_string(n_temporary++);
  }

  /* The call of a kernel, whose results stand in r1, r2, .. */
  void call_kernel(int i)
  {
    const graph &inner = R.all[(std::size_t)of_graph->nodes[(std::size_t)i].a.d];
    const kernel_text &k = kernel.at(inner.kind);
    const std::string results = "r" + std::to_string(n_call++);
    std::string arguments;
    for (number a : inner.arguments) {
      arguments += (arguments.empty() ? "" : ", ") + of(a);
    }
    text[(std::size_t)i] = results;
    line(real + " " + results + "[" + std::to_string(k.results.empty() ? 1 : k.results.size()) + "];");
    line("{");
    if (!inner.arguments.empty()) {
      line("  const " + real + " a[" + std::to_string(inner.arguments.size()) + "] = {" + arguments + "};");
    }
    line("  const " + name + "_status status = " + k.name + "(" + results +
         (inner.arguments.empty() ? ", NULL);" : ", a);"));
    line("  if (status != " + name + "_ok) {");
    line("    return status;");
    line("  }");
    line("}");
  }

  /* Node i as a statement, or as text for where it is used. */
  void statement(int i)
  {
    const node &n = of_graph->nodes[(std::size_t)i];
    std::string s;
    if (n.op == 'i') {
      text[(std::size_t)i] = names[(std::size_t)n.a.d];
      return;
    }
    if (n.op == 'k') {
      call_kernel(i);
      return;
    }
    if (n.op == 'r') {
      const graph &inner = R.all[(std::size_t)of_graph->nodes[(std::size_t)node_of(n.a)].a.d];
      text[(std::size_t)i] = of(n.a) + "[" + std::to_string(kernel.at(inner.kind).results.at((int)n.b.d)) + "]";
      return;
    }
    s = expression(n);
    const bool plain = std::strchr("qscfet", n.op) != nullptr;
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
    line("if (" + std::string(c.outcome ? "!(" : "") + s + (c.outcome ? ")" : "") + ") {");
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

  /* Results of a graph to `to`, with statements of all that they need. */
  void body(const graph &g, const std::vector<std::pair<std::string, number>> &results)
  {
    std::vector<number> of_results;
    for (const auto &r : results) {
      of_results.push_back(r.second);
    }
    const std::vector<char> live = needed(g, of_results, true);
    of_graph = &g;
    uses.assign(g.nodes.size(), 0);
    text.assign(g.nodes.size(), "");
    n_temporary = n_call = 0;
    auto use = [&](number a) { uses[(std::size_t)node_of(a)]++; };
    for (std::size_t i = 1; i < live.size(); i++) {
      if (live[i] && g.nodes[i].op == 'k') {
        for (number a : R.all[(std::size_t)g.nodes[i].a.d].arguments) {
          use(a);
        }
      } else if (live[i] && g.nodes[i].op != 'i') {
        use(g.nodes[i].a), use(g.nodes[i].b), use(g.nodes[i].c);
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
    std::size_t next = 0;
    for (std::size_t i = 1; i <= live.size(); i++) {
      for (; next < g.guards.size() && g.guards[next].after < (int)i; next++) {
        if (g.guards[next].status != 0) {
          check(g.guards[next]);
        }
      }
      if (i < live.size() && live[i]) {
        statement((int)i);
      }
    }
    for (number r : of_results) {
      std::string &own = text[(std::size_t)node_of(r)];
      if (settled && node_of(r) && own[0] != 't' && own[0] != 'r') {
        const std::string known = temporary();
        line("const " + real + " " + known + " = " + own + ";");
        own = known;
      }
    }
    for (const auto &r : results) {
      line(r.first + " = " + of(r.second) + ";");
    }
  }
};

} // namespace trace
#endif
