/* text.h - a graph as C99: one statement for what is used more than once or would be too long, in the order of the library;
   the rest stands where it is used. */
#ifndef TRACE_TEXT_H
#define TRACE_TEXT_H
#include "graph.h"
#include <cstdio>

namespace trace
{

enum { LONGEST = 100 }; /* characters of an expression in another */

struct writer {
  FILE *out;
  std::string name, real; /* of the model: prefix of all names; its type of numbers */
  bool single;
  int n_state; /* inputs of the graph before those of the model */
  std::vector<int> uses;
  std::vector<std::string> text; /* of each node, once it is known */
  int n_temporary;

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

  /* Node i as a statement, or as text for where it is used. */
  void statement(int i)
  {
    const node &n = G.nodes[(std::size_t)i];
    std::string s;
    if (n.op == 'i') {
      const int at = (int)n.a.d;
      text[(std::size_t)i] = (at < n_state ? "x[" : "u[") + std::to_string(at < n_state ? at : at - n_state) + "]";
      return;
    }
    s = expression(n);
    const bool plain = std::strchr("qscfet", n.op) != nullptr;
    if (std::strchr("<l=", n.op) || (uses[(std::size_t)i] == 1 && s.size() < LONGEST)) {
      text[(std::size_t)i] = plain ? s : "(" + s + ")";
      return;
    }
    text[(std::size_t)i] = "t" + std::to_string(n_temporary++);
    line("const " + real + " " + text[(std::size_t)i] + " = " + s + ";");
  }

  void check(const guard &c) const
  {
    const std::string s = comparison(c.relation, c.a, c.b);
    line("if (" + std::string(c.outcome ? "!(" : "") + s + (c.outcome ? ")" : "") + ") {");
    line("  return " + (c.status == BRANCH ? name + "_ERR_BRANCH" : std::to_string(c.status)) + ";" +
         (c.what.empty() ? "" : " /* " + c.what + " */"));
    line("}");
  }

  /* A function of x and u: results to `to`, statements of all that they need. */
  void body(const std::vector<std::pair<std::string, number>> &results)
  {
    std::vector<number> of_results;
    for (const auto &r : results) {
      of_results.push_back(r.second);
    }
    const std::vector<char> live = needed(of_results, true);
    uses.assign(G.nodes.size(), 0);
    text.assign(G.nodes.size(), "");
    n_temporary = 0;
    auto use = [&](number a) { uses[(std::size_t)node_of(a)]++; };
    for (std::size_t i = 1; i < live.size(); i++) {
      if (live[i] && G.nodes[i].op != 'i') {
        use(G.nodes[i].a), use(G.nodes[i].b), use(G.nodes[i].c);
      }
    }
    for (number r : of_results) {
      use(r);
    }
    for (const guard &c : G.guards) {
      if (c.status != 0) {
        use(c.a), use(c.b);
      }
    }
    std::size_t g = 0;
    for (std::size_t i = 1; i <= live.size(); i++) {
      for (; g < G.guards.size() && G.guards[g].after < (int)i; g++) {
        if (G.guards[g].status != 0) {
          check(G.guards[g]);
        }
      }
      if (i < live.size() && live[i]) {
        statement((int)i);
      }
    }
    for (const auto &r : results) {
      line(r.first + " = " + of(r.second) + ";");
    }
    std::fprintf(out, "  (void)x, (void)u;\n  return 0;\n}\n\n");
  }
};

} // namespace trace
#endif
