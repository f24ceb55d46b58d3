/* derive.h - gradients of the results of a graph, appended to it. */
#ifndef TRACE_DERIVE_H
#define TRACE_DERIVE_H
#include "graph.h"

namespace trace
{

typedef std::map<int, number> gradient; /* by node, or by input */

/* d(node)/d(operand) of node i, by operand. */
static gradient partials_of(int i)
{
  const node n = here().nodes[(std::size_t)i]; /* a copy: nodes are appended */
  const number self = number_of(R.now, i);
  gradient g;
  auto add = [&](number of, number x) {
    if (node_of(of)) {
      const auto found = g.find(node_of(of));
      g[node_of(of)] = found == g.end() ? x : found->second + x;
    }
  };
  switch (n.op) {
  case '+':
    add(n.a, 1.0), add(n.b, 1.0);
    break;
  case '-':
    add(n.a, 1.0), add(n.b, -1.0);
    break;
  case '*':
    add(n.a, n.b), add(n.b, n.a);
    break;
  case '/': {
    const number by = number(1.0) / n.b;
    add(n.a, by), add(n.b, -(self * by));
    break;
  }
  case 'n':
    add(n.a, -1.0);
    break;
  case 'q':
    add(n.a, number(0.5) / self);
    break;
  case 's':
    add(n.a, apply('c', n.a));
    break;
  case 'c':
    add(n.a, -apply('s', n.a));
    break;
  case 't': {
    const number by = number(1.0) / (n.a * n.a + n.b * n.b);
    add(n.a, n.b * by), add(n.b, -(n.a * by));
    break;
  }
  case 'f':
    add(n.a, select('<', n.a, 0.0, -1.0, 1.0));
    break;
  case 'e':
    add(n.a, self);
    break;
  case '?':
    add(n.b, make('?', n.a, 1.0, 0.0)), add(n.c, make('?', n.a, 0.0, 1.0));
    break;
  default:
    break; /* an input, a comparison */
  }
  return g;
}

/* Gradients of the results by elimination: the graph with the partial derivatives on its edges loses one node after the
   other, each replaced by edges from what it depends on to what depends on it, cheapest first, until results hang on
   inputs alone. Forward and backward differentiation are two orders of the same; the cheapest first (Markowitz) takes
   half the operations of the better one. Source: A. Griewank, A. Walther, Evaluating Derivatives, 2nd ed., chapters 9, 10. */
static std::vector<gradient> differentiate(const std::vector<number> &results)
{
  const std::vector<char> live = needed(here(), results, false);
  const std::size_t n = live.size();
  std::vector<gradient> of(n);             /* edges into a node */
  std::vector<std::set<int>> to(n);        /* what depends on it */
  std::vector<char> kept(n, 0);            /* a result */
  std::set<std::pair<long, int>> cheapest; /* products that its elimination takes */
  for (number r : results) {
    kept[(std::size_t)node_of(r)] = 1;
  }
  for (std::size_t i = 1; i < n; i++) {
    for (const auto &e : live[i] ? partials_of((int)i) : gradient()) {
      const std::size_t on = (std::size_t)e.first;
      if (here().nodes[on].op == 'i' || !of[on].empty()) { /* else it is a sign: constant, but for where it jumps */
        of[i].insert(e);
        to[on].insert((int)i);
      }
    }
  }
  auto cost = [&](int i) { return (long)(of[(std::size_t)i].size() * to[(std::size_t)i].size()); };
  auto is_inner = [&](int i) { return live[(std::size_t)i] && !of[(std::size_t)i].empty() && !kept[(std::size_t)i]; };
  for (int i = 1; i < (int)n; i++) {
    if (is_inner(i)) {
      cheapest.insert({cost(i), -i});
    }
  }
  while (!cheapest.empty()) {
    const int i = -cheapest.begin()->second;
    const gradient in = of[(std::size_t)i];
    const std::set<int> out = to[(std::size_t)i];
    std::set<int> touched(out);
    for (const auto &e : in) {
      touched.insert(e.first);
    }
    touched.insert(i);
    for (int k : touched) {
      cheapest.erase({cost(k), -k});
    }
    for (int k : out) {
      gradient &edges = of[(std::size_t)k];
      const number by = edges[i];
      edges.erase(i);
      for (const auto &e : in) {
        const auto found = edges.find(e.first);
        const number term = by * e.second;
        edges[e.first] = found == edges.end() ? term : found->second + term;
        to[(std::size_t)e.first].insert(k);
      }
    }
    for (const auto &e : in) {
      to[(std::size_t)e.first].erase(i);
    }
    of[(std::size_t)i].clear();
    to[(std::size_t)i].clear();
    touched.erase(i);
    for (int k : touched) {
      if (is_inner(k)) {
        cheapest.insert({cost(k), -k});
      }
    }
  }

  /* results that depend on other results, and by input in place of node */
  std::vector<gradient> all;
  std::map<int, gradient> done;
  for (std::size_t i = 1; i < n; i++) {
    if (!kept[i]) {
      continue;
    }
    gradient g;
    auto add = [&](int at, number x) {
      const auto found = g.find(at);
      g[at] = found == g.end() ? x : found->second + x;
    };
    if (here().nodes[i].op == 'i') {
      g[(int)here().nodes[i].a.d] = 1.0;
    }
    for (const auto &e : of[i]) {
      if (kept[(std::size_t)e.first] && here().nodes[(std::size_t)e.first].op != 'i') {
        for (const auto &inner : done[e.first]) {
          add(inner.first, e.second * inner.second);
        }
      } else {
        add((int)here().nodes[(std::size_t)e.first].a.d, e.second);
      }
    }
    done[(int)i] = g;
  }
  for (number r : results) {
    gradient g;
    for (const auto &e : done[node_of(r)]) {
      if (!is(e.second, 0.0)) {
        g.insert(e);
      }
    }
    all.push_back(g);
  }
  return all;
}

} // namespace trace
#endif
