/* given.h - what is zero where inputs are not given (NULL), and so is left out there: an unloaded step computes no loads. */
#ifndef TRACE_GIVEN_H
#define TRACE_GIVEN_H
#include "graph.h"

namespace trace
{

/* Of a kernel: arguments that are zero in all of its calls unless their inputs are given, and nodes that then are. */
struct quiet_kernel {
  std::vector<char> argument;
  std::set<int> node;
};

typedef std::map<std::uint64_t, quiet_kernel> quiet_kernels; /* by their kind */

/* Bits of the inputs whose arguments of a call are zero without them; 0: none. */
static unsigned inputs_of_call(const graph &inner, const quiet_kernels &kernels, const std::vector<unsigned> &of)
{
  const auto found = kernels.find(inner.kind);
  unsigned bits = 0;
  for (std::size_t i = 0; found != kernels.end() && i < inner.arguments.size(); i++) {
    bits |= found->second.argument[i] ? of[(std::size_t)node_of(inner.arguments[i])] : 0u;
  }
  return bits;
}

/* Per node of a graph the bits of the inputs without which it is zero; 0: it never is for sure. given: of its inputs;
   of none, all are given. */
static std::vector<unsigned> zero_without(const graph &g, const std::vector<unsigned> &given,
                                          const quiet_kernels &kernels)
{
  std::vector<unsigned> of(g.nodes.size(), 0);
  auto at = [&](number a) { return node_of(a) ? of[(std::size_t)node_of(a)] : 0u; };
  auto vanishes = [&](number a) { return at(a) != 0u || is(a, 0.0); };
  for (std::size_t i = 1; i < g.nodes.size(); i++) {
    const node &n = g.nodes[i];
    if (n.op == 'i') {
      of[i] = given.empty() ? 0u : given[(std::size_t)n.a.d];
    } else if (n.op == 'r') {
      const graph &inner = R.all[(std::size_t)g.nodes[(std::size_t)node_of(n.a)].a.d];
      const auto found = kernels.find(inner.kind);
      const bool quiet = found != kernels.end() && found->second.node.count((int)n.b.d) > 0;
      of[i] = quiet ? inputs_of_call(inner, kernels, of) : 0u;
    } else if (n.op == '*') {
      of[i] = at(n.a) ? at(n.a) : at(n.b);
    } else if (std::strchr("/nfqsz", n.op)) {
      of[i] = at(n.a);
    } else if (std::strchr("+-", n.op)) {
      of[i] = vanishes(n.a) && vanishes(n.b) ? at(n.a) | at(n.b) : 0u;
    } else if (n.op == '?') {
      of[i] = vanishes(n.b) && vanishes(n.c) ? at(n.b) | at(n.c) : 0u;
    }
  }
  return of;
}

/* Of the kernels that graph 0 of R calls: what all calls have in common. given: of the inputs of graph 0. */
static void find_quiet(quiet_kernels &kernels, const std::vector<unsigned> &given)
{
  std::vector<std::vector<unsigned>> of(R.all.size());
  for (std::size_t g = 0; g < R.all.size(); g++) { /* callers come before what they call */
    const graph &own = R.all[g];
    std::vector<unsigned> inputs = given;
    if (own.loops) { /* is always computed */
      continue;
    }
    if (g > 0) {
      const std::vector<unsigned> &outer = of[(std::size_t)own.parent];
      const auto found = kernels.insert({own.kind, {std::vector<char>(own.arguments.size(), 1), {}}});
      quiet_kernel &k = found.first->second;
      inputs.clear();
      for (std::size_t i = 0; i < own.arguments.size(); i++) {
        k.argument[i] &= outer[(std::size_t)node_of(own.arguments[i])] != 0u;
        inputs.push_back(k.argument[i] ? 1u : 0u);
      }
    }
    of[g] = zero_without(own, inputs, kernels);
    for (std::size_t i = 1; g > 0 && i < of[g].size(); i++) {
      if (of[g][i]) {
        kernels[own.kind].node.insert((int)i);
      } else {
        kernels[own.kind].node.erase((int)i);
      }
    }
  }
}

/* In which order a graph is written: nodes and guards, with the inputs whose absence leaves them out. */
struct item {
  bool check;
  int at;        /* a node, a guard */
  unsigned bits; /* of inputs; 0: always written */
  int block;     /* of items that stand together; 0: in none */
};

struct order_of_items {
  const graph &g;
  const std::vector<unsigned> &of;
  std::vector<item> items;
  std::map<unsigned, std::vector<int>> waiting; /* nodes, by their inputs */
  std::vector<char> written;
  int block = 0;

  order_of_items(const graph &graph, const std::vector<char> &live, const std::vector<unsigned> &zero)
      : g(graph), of(zero), written(graph.nodes.size(), 0)
  {
    std::size_t next = 0;
    for (std::size_t i = 1; i <= g.nodes.size(); i++) {
      for (; next < g.guards.size() && g.guards[next].after < (int)i; next++) {
        if (g.guards[next].status != 0) {
          add_guard((int)next);
        }
      }
      if (i < g.nodes.size() && live[i]) {
        if (of[i] && !std::strchr("iklr", g.nodes[i].op)) {
          waiting[of[i]].push_back((int)i);
        } else {
          add((int)i);
        }
      }
    }
    for (const auto &w : std::map<unsigned, std::vector<int>>(waiting)) {
      release(w.first);
    }
  }

  void need(number a)
  {
    if (node_of(a) && !written[(std::size_t)node_of(a)]) {
      release(of[(std::size_t)node_of(a)]);
    }
  }

  void need_operands(int i)
  {
    const node &n = g.nodes[(std::size_t)i];
    if (is_call(n)) {
      for (number a : R.all[(std::size_t)n.a.d].arguments) {
        need(a);
      }
    }
    for (number a : operands(g, n)) {
      need(a);
    }
  }

  void add(int i)
  {
    need_operands(i);
    items.push_back({false, i, 0u, 0});
    written[(std::size_t)i] = 1;
  }

  /* All that waits for the same inputs, in a block. */
  void release(unsigned bits)
  {
    const std::vector<int> list = waiting[bits];
    waiting[bits].clear();
    for (int i : list) { /* what they need of others first */
      const node &n = g.nodes[(std::size_t)i];
      for (number a : {n.a, n.b, n.c}) {
        if (node_of(a) && of[(std::size_t)node_of(a)] != bits) {
          need(a);
        }
      }
    }
    block += !list.empty();
    for (int i : list) {
      items.push_back({false, i, bits, block});
      written[(std::size_t)i] = 1;
    }
  }

  void add_guard(int at)
  {
    const guard &c = g.guards[(std::size_t)at];
    const unsigned a = node_of(c.a) ? of[(std::size_t)node_of(c.a)] : 0u;
    const bool quiet = a && !node_of(c.b) && (evaluate(c.relation, 0.0, value(c.b), 0.0) != 0.0) == c.outcome;
    need(c.a), need(c.b);
    if (quiet && !items.empty() && items.back().bits == a) {
      items.push_back({true, at, a, block});
    } else {
      block += quiet;
      items.push_back({true, at, quiet ? a : 0u, quiet ? block : 0});
    }
  }
};

} // namespace trace
#endif
