/* loops.h - calls of a kernel, each of which takes what the one before it left: the turns of a loop. */
#ifndef TRACE_LOOPS_H
#define TRACE_LOOPS_H
#include "graph.h"
#include <algorithm>

namespace trace
{

struct loop {
  std::vector<int> calls;     /* nodes of the graph that calls */
  std::map<int, int> carried; /* arguments that are results of the turn before, and which nodes of it */
};

static const graph &called_by(const graph &g, int call)
{
  return R.all[(std::size_t)g.nodes[(std::size_t)call].a.d];
}

/* Does a call go on with a loop? Its arguments are those of the turns before or, always the same, what they leave. */
static bool goes_on(loop &l, const graph &g, int call)
{
  const graph &before = called_by(g, l.calls.back()), &now = called_by(g, call);
  std::map<int, int> carried;
  if (before.kind != now.kind || now.slots.empty()) {
    return false;
  }
  for (std::size_t a = 0; a < now.arguments.size(); a++) {
    const number x = now.arguments[a];
    const node *const n = node_of(x) ? &g.nodes[(std::size_t)node_of(x)] : nullptr;
    if (n && n->op == 'r' && node_of(n->a) == l.calls.back()) {
      carried[(int)a] = (int)n->b.d;
    } else if (bits(x) != bits(before.arguments[a])) {
      return false;
    }
  }
  if (l.calls.size() > 1 && carried != l.carried) {
    return false;
  }
  l.carried = carried;
  return true;
}

/* Is what a turn leaves used by the next one alone, but for the last? live: of the nodes. */
static bool is_closed(const loop &l, const graph &g, const std::vector<char> &live)
{
  const std::set<int> inner(l.calls.begin(), l.calls.end() - 1);
  std::vector<char> left(g.nodes.size(), 0);
  bool closed = true;
  auto look = [&](number a) { closed = closed && !(node_of(a) && left[(std::size_t)node_of(a)]); };
  for (std::size_t i = 1; i < g.nodes.size(); i++) {
    const node &n = g.nodes[i];
    left[i] = n.op == 'r' && inner.count(node_of(n.a));
    if (!live[i]) {
      continue;
    }
    if (is_call(n) && !(std::find(l.calls.begin(), l.calls.end(), (int)i) != l.calls.end())) {
      for (number a : called_by(g, (int)i).arguments) {
        look(a);
      }
    }
    for (number a : operands(g, n)) {
      look(a);
    }
  }
  for (const guard &c : g.guards) {
    if (c.status != 0) {
      look(c.a), look(c.b);
    }
  }
  return closed;
}

/* The loops of a graph, by their first call. */
static std::map<int, loop> loops_of(const graph &g, const std::vector<char> &live)
{
  std::map<int, loop> all, closed;
  loop now;
  for (std::size_t i = 1; i < g.nodes.size(); i++) {
    if (g.nodes[i].op != 'k') {
      continue;
    }
    if (now.calls.empty() || !goes_on(now, g, (int)i)) {
      now = loop();
    }
    now.calls.push_back((int)i);
    if (now.calls.size() > 1) {
      all[now.calls[0]] = now;
    }
  }
  for (const auto &l : all) {
    if (is_closed(l.second, g, live)) {
      closed.insert(l);
    }
  }
  return closed;
}

} // namespace trace
#endif
