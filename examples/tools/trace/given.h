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

/* What is zero whatever is given, of numbers of a loop. */
const unsigned always_zero = 1u << 31;

/* Bits of a number by those of nodes; 0: it never is zero for sure. */
static unsigned bits_of(number a, const std::vector<unsigned> &of)
{
  return node_of(a) ? of[(std::size_t)node_of(a)] : is(a, 0.0) ? always_zero : 0u;
}

/* Bits of numbers that are zero together. */
static unsigned bits_of_all(unsigned bits, unsigned more)
{
  return bits && more ? bits | more : 0u;
}

static unsigned inputs_of_loop(const graph &loop, const std::vector<unsigned> &of, const quiet_kernels &kernels);

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
    } else if (n.op == 'l') {
      of[i] = inputs_of_loop(R.all[(std::size_t)n.a.d], of, kernels);
    } else if (n.op == 'r' && g.nodes[(std::size_t)node_of(n.a)].op == 'l') {
      of[i] = at(n.a);
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

/* Bits of the inputs without which all results of a loop are zero; 0: they are not, or it checks something. of: those of
   the graph around it. What is carried is taken to be zero until what it becomes is found not to be. */
static unsigned inputs_of_loop(const graph &loop, const std::vector<unsigned> &of, const quiet_kernels &kernels)
{
  std::vector<unsigned> given, own;
  unsigned all = always_zero;
  for (const feed &s : loop.feeds) {
    given.push_back(always_zero);
    for (int k = 0; k < arguments_of(loop, s); k++) {
      given.back() = bits_of_all(given.back(), bits_of(loop.arguments[(std::size_t)(s.first + k)], of));
    }
  }
  for (bool more = true; more;) {
    more = false;
    own = zero_without(loop, given, kernels);
    for (std::size_t k = 0; k < given.size(); k++) {
      const feed &s = loop.feeds[k];
      const unsigned next = s.is == feed::CARRIED ? bits_of_all(given[k], bits_of(s.next, own)) : given[k];
      more = more || next != given[k];
      given[k] = next;
    }
  }
  for (const auto &r : loop.results) {
    all = bits_of_all(all, own[(std::size_t)r.first % loop.nodes.size()]);
  }
  return checks_anything(loop) ? 0u : all & ~always_zero;
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
  const std::vector<char> &live;
  std::vector<item> items;
  std::map<unsigned, std::vector<int>> waiting; /* nodes, by their inputs */
  std::vector<char> written;
  std::map<int, std::vector<int>> given_by; /* results of loops, which stand in the block of their loop */
  int block = 0;

  order_of_items(const graph &graph, const std::vector<char> &needed, const std::vector<unsigned> &zero)
      : g(graph), of(zero), live(needed), written(graph.nodes.size(), 0)
  {
    std::size_t next = 0;
    for (std::size_t i = 1; i < g.nodes.size(); i++) {
      if (live[i] && g.nodes[i].op == 'r') {
        given_by[node_of(g.nodes[i].a)].push_back((int)i);
      }
    }
    for (std::size_t i = 1; i <= g.nodes.size(); i++) {
      for (; next < g.guards.size() && g.guards[next].after < (int)i; next++) {
        if (g.guards[next].status != 0) {
          add_guard((int)next);
        }
      }
      if (i < g.nodes.size() && live[i] && !written[i]) {
        if (of[i] && waits(g.nodes[i])) {
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

  /* What a kernel gives is known with its call, what a loop gives with the loop. */
  bool waits(const node &n) const
  {
    return !std::strchr("ikr", n.op) || (n.op == 'r' && g.nodes[(std::size_t)node_of(n.a)].op == 'l');
  }

  void need(number a)
  {
    const std::size_t i = (std::size_t)node_of(a);
    if (i == 0 || written[i] || !live[i]) {
      return;
    }
    if (of[i] && waits(g.nodes[i])) {
      waiting[of[i]].push_back((int)i);
      release(of[i]);
    } else {
      add((int)i); /* of what is done where a loop before it is (join.h) */
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
    place(i, 0u, 0);
  }

  void place(int i, unsigned bits, int in)
  {
    if (written[(std::size_t)i]) {
      return;
    }
    items.push_back({false, i, bits, in});
    written[(std::size_t)i] = 1;
    for (std::size_t k = 0; g.nodes[(std::size_t)i].op == 'l' && k < given_by[i].size(); k++) {
      place(given_by[i][k], bits, in);
    }
  }

  /* What node i needs, of that which waits for the same inputs to the list, the rest before. */
  void gather(std::vector<int> &list, std::vector<char> &seen, int i, unsigned bits)
  {
    const node &n = g.nodes[(std::size_t)i];
    seen[(std::size_t)i] = 1;
    for (number a : n.op == 'l' ? R.all[(std::size_t)n.a.d].arguments : std::vector<number>{n.a, n.b, n.c}) {
      const std::size_t on = (std::size_t)node_of(a);
      if (on > 0 && of[on] == bits && waits(g.nodes[on]) && live[on]) {
        if (!written[on] && !seen[on]) {
          gather(list, seen, (int)on, bits);
        }
      } else {
        need(a);
      }
    }
    list.push_back(i);
  }

  /* All that waits for the same inputs, in a block. */
  void release(unsigned bits)
  {
    const std::vector<int> of_bits = waiting[bits];
    std::vector<int> list;
    std::vector<char> seen(g.nodes.size(), 0);
    waiting[bits].clear();
    for (int i : of_bits) {
      if (!seen[(std::size_t)i]) {
        gather(list, seen, i, bits);
      }
    }
    block += !list.empty();
    for (int i : list) {
      place(i, bits, block);
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
