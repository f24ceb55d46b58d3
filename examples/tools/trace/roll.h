/* roll.h - loops that are marked (FB_LOOP of flexbeam_impl.h) as one iteration that stands for all. The history of operations
   of a loop has a part for each iteration; where the operations are the same ones, and their operands come from the same
   place in the iteration, from the iteration before, or from outside, it is a loop again, with tables of what differs. */
#ifndef TRACE_ROLL_H
#define TRACE_ROLL_H
#include "graph.h"
#include <algorithm>

namespace trace
{

/* A loop in a loop is part of its iterations. */
bool loop_begin(bool pairs)
{
  if (!R.on || !R.loops || here().loops) {
    return false;
  }
  graph g;
  g.name = "loop";
  g.loops = true;
  g.pairs = pairs;
  g.parent = R.now;
  R.now = (int)R.all.size();
  R.all.push_back(g);
  return true;
}

void loop_next()
{
  here().starts.push_back((int)here().nodes.size());
  push(R.now, {'.', 0, 0, 0, 0.0}); /* so that each guard stands behind a node of its iteration */
}

/* Numbers that loops take one after the other. */
void span(const number *x, int n)
{
  std::vector<number> list;
  for (int k = 0; k < n && R.on && R.loops && !here().loops; k++) {
    const graph &g = R.all[node_of(x[k]) ? (std::size_t)graph_of(x[k]) : 0];
    if (node_of(x[k]) && graph_of(x[k]) != R.now && (g.open || g.parent != R.now)) {
      return;
    }
    list.push_back(local(x[k]));
  }
  if (!list.empty()) {
    here().spans.push_back(list);
  }
}

/* A recorded loop, and where each node stands in its iteration. */
struct history {
  /* Iterations as they are; of each the first and the second half; of loops over pairs the first and the second of
     each, all the first ones before the second ones where they are sums. */
  enum cut { WHOLE, HALVES, PAIRS, SUMS };
  graph of;
  std::vector<int> iteration, place;    /* of nodes; place -1: an input or none */
  std::vector<std::vector<int>> list;   /* nodes of each iteration */
  std::vector<std::vector<int>> guards; /* likewise */
  int lanes = 1;

  history(const graph &g) : of(g)
  {
    for (std::size_t j = 0; j < of.starts.size(); j++) {
      const std::size_t end = j + 1 < of.starts.size() ? (std::size_t)of.starts[j + 1] : of.nodes.size();
      list.push_back({}), guards.push_back({});
      for (std::size_t i = (std::size_t)of.starts[j]; i < end; i++) {
        if (of.nodes[i].op != 'i' && of.nodes[i].op != '.') {
          list.back().push_back((int)i);
        }
      }
      for (std::size_t k = 0; k < of.guards.size(); k++) {
        if (of.guards[k].after >= of.starts[j] && of.guards[k].after < (int)end) {
          guards.back().push_back((int)k);
        }
      }
    }
    number_nodes();
  }

  void number_nodes()
  {
    iteration.assign(of.nodes.size(), -1), place.assign(of.nodes.size(), -1);
    for (std::size_t j = 0; j < list.size(); j++) {
      for (std::size_t k = 0; k < list[j].size(); k++) {
        iteration[(std::size_t)list[j][k]] = (int)j;
        place[(std::size_t)list[j][k]] = (int)k;
      }
    }
  }

  /* Numbers of the parts of an iteration that have nothing to do with each other, by operation. */
  std::vector<int> parts() const
  {
    std::vector<int> part;
    for (std::size_t k = 0; k < list[0].size(); k++) {
      part.push_back((int)k);
    }
    for (std::size_t k = 0; k < part.size(); k++) { /* in iteration 1: with what is carried */
      const node &n = of.nodes[(std::size_t)list[1][k]];
      for (number a : {n.a, n.b, n.c}) {
        const int other = node_of(a) ? place[(std::size_t)node_of(a)] : -1;
        if (other >= 0 && other < (int)part.size()) {
          const int from = part[(std::size_t)other], to = part[k];
          std::replace(part.begin(), part.end(), std::max(from, to), std::min(from, to));
        }
      }
    }
    return part;
  }

  /* With two parts of each iteration as iterations of their own; false: it has none. */
  bool divide(cut by)
  {
    auto differs = [&](const std::vector<int> &own) { return own.size() != list[0].size(); };
    if (!of.guards.empty() || list.size() < 2 || std::any_of(list.begin(), list.end(), differs) || list[0].size() % 2) {
      return false;
    }
    const std::size_t n = list[0].size(), trips = list.size();
    std::vector<int> second(n); /* 1: operations of the second part */
    for (std::size_t k = 0; k < n; k++) {
      second[k] = k >= n / 2;
    }
    if (by != HALVES) {
      const std::vector<int> part = parts();
      std::vector<int> names = part;
      std::sort(names.begin(), names.end());
      names.erase(std::unique(names.begin(), names.end()), names.end());
      const bool in_turn = of_pairs(part, names, 1);
      if (names.size() % 2 || (!in_turn && !of_pairs(part, names, names.size() / 2))) {
        return false;
      }
      for (std::size_t k = 0; k < n; k++) {
        const std::size_t rank = (std::size_t)(std::find(names.begin(), names.end(), part[k]) - names.begin());
        second[k] = in_turn ? rank % 2 : rank >= names.size() / 2;
      }
    }
    std::vector<std::vector<int>> divided(2 * trips);
    for (std::size_t j = 0; j < trips; j++) {
      for (std::size_t k = 0; k < n; k++) {
        const std::size_t lane = (std::size_t)second[k];
        divided[by == SUMS ? lane * trips + j : 2 * j + lane].push_back(list[j][k]);
      }
    }
    list = divided;
    guards.resize(list.size());
    lanes = by == SUMS ? 2 : 1;
    number_nodes();
    return true;
  }

  /* Have parts the same operations as those `apart` behind? */
  bool of_pairs(const std::vector<int> &part, const std::vector<int> &names, std::size_t apart) const
  {
    std::map<int, std::string> ops;
    for (std::size_t k = 0; k < part.size(); k++) {
      ops[part[k]] += of.nodes[(std::size_t)list[0][k]].op;
    }
    for (std::size_t k = 0; k < names.size(); k++) {
      if (k / apart % 2 == 0 && (k + apart >= names.size() || ops[names[k]] != ops[names[k + apart]])) {
        return false;
      }
    }
    return true;
  }

  int trips() const
  {
    return (int)list.size();
  }

  /* Operations of an iteration before a guard. */
  int before(const guard &c) const
  {
    int i = c.after;
    while (place[(std::size_t)i] < 0 && of.nodes[(std::size_t)i].op != '.') {
      i--;
    }
    return place[(std::size_t)i] + 1;
  }

  /* A number that an iteration has not made itself: of the parent, a constant, or a node of the iteration before. */
  number outer(number a) const
  {
    return node_of(a) && of.nodes[(std::size_t)node_of(a)].op == 'i'
               ? of.arguments[(std::size_t)of.nodes[(std::size_t)node_of(a)].a.d]
               : a;
  }

  bool is_own(number a, int trip) const
  {
    return node_of(a) && iteration[(std::size_t)node_of(a)] == trip;
  }

  bool are_alike() const
  {
    for (int j = 1; j < trips(); j++) {
      const std::vector<int> &first = list[0], &other = list[(std::size_t)j];
      if (first.size() != other.size() || guards[0].size() != guards[(std::size_t)j].size()) {
        return false;
      }
      for (std::size_t i = 0; i < first.size(); i++) {
        if (of.nodes[(std::size_t)first[i]].op != of.nodes[(std::size_t)other[i]].op) {
          return false;
        }
      }
      for (std::size_t k = 0; k < guards[0].size(); k++) {
        const guard &a = of.guards[(std::size_t)guards[0][k]], &b = of.guards[(std::size_t)guards[(std::size_t)j][k]];
        if (a.relation != b.relation || a.outcome != b.outcome || before(a) != before(b)) {
          return false;
        }
      }
    }
    return true;
  }
};

/* The body of a loop from its history. */
struct roller {
  const history &h;
  const int graph_at;
  std::vector<std::vector<number>> lists; /* by slot */
  std::vector<number> stand;              /* of operations: numbers of the body */
  std::vector<number> inputs;             /* of the body, by slot */

  roller(const history &of, int at) : h(of), graph_at(at)
  {
  }

  graph &body() const
  {
    return R.all[(std::size_t)graph_at];
  }

  /* Operand of operation i, or of a guard, in all iterations; the slot for it in `slot_of`, -1: the iteration's own.
     false: they differ. */
  template <class get> bool take(get operand, int &slot_of)
  {
    std::vector<number> list;
    const number first = operand(0);
    int carried = -1;
    slot_of = -1;
    if (h.is_own(first, 0)) {
      for (int j = 1; j < h.trips(); j++) {
        const number a = operand(j);
        if (!h.is_own(a, j) || h.place[(std::size_t)node_of(a)] != h.place[(std::size_t)node_of(first)]) {
          return false;
        }
      }
      return true;
    }
    for (int j = 0; j < h.trips(); j++) {
      const number a = operand(j);
      const int of = node_of(a) ? h.iteration[(std::size_t)node_of(a)] : -1;
      const int place_now = of >= 0 ? h.place[(std::size_t)node_of(a)] : -1;
      const bool starts = j % (h.trips() / h.lanes) == 0;
      carried = j == 1 ? place_now : carried;
      if ((of >= 0 && of != j - 1) || place_now != (starts ? -1 : carried)) {
        return false;
      }
      list.push_back(h.outer(a));
    }
    auto same = [&](const std::vector<number> &other) {
      return std::equal(list.begin(), list.end(), other.begin(), [](number x, number y) { return bits(x) == bits(y); });
    };
    slot_of = (int)(std::find_if(lists.begin(), lists.end(), same) - lists.begin());
    if (slot_of == (int)lists.size()) {
      lists.push_back(list);
    }
    return true;
  }

  /* The operation that is carried, -1: none. */
  int carried(std::size_t s) const
  {
    const number last = lists[s].back();
    return node_of(last) && graph_of(last) == graph_at ? h.place[(std::size_t)node_of(last)] : -1;
  }

  /* The slot stays what it is at the start of each lane. */
  void stay(std::size_t s)
  {
    const std::size_t length = lists[s].size() / (std::size_t)h.lanes;
    for (std::size_t j = 0; j < lists[s].size(); j++) {
      lists[s][j] = lists[s][j / length * length];
    }
  }

  /* Inputs, of the kinds that the lists are. */
  void begin()
  {
    graph g;
    g.name = body().name;
    g.loops = true;
    g.parent = body().parent;
    g.lanes = h.lanes;
    body() = g;
    inputs.clear(), stand.clear();
    for (std::size_t s = 0; s < lists.size(); s++) {
      const std::vector<number> &list = lists[s];
      auto differs = [&](number a) { return bits(a) != bits(list[0]); };
      const bool is_list = carried(s) < 0 && std::any_of(list.begin(), list.end(), differs);
      if (carried(s) < 0 && !is_list && !node_of(list[0])) {
        inputs.push_back(list[0]);
        continue;
      }
      const feed::kind is = carried(s) >= 0 ? feed::CARRIED : is_list ? feed::LISTED : feed::STAYS;
      inputs.push_back(push(graph_at, {'i', (int)body().feeds.size(), 0, 0, value(list[0])}));
      body().feeds.push_back({is, (int)body().arguments.size(), 0});
      for (std::size_t j = 0; j < (is == feed::STAYS ? 1 : list.size()); j++) {
        if (is_list || j % (list.size() / (std::size_t)h.lanes) == 0) {
          body().arguments.push_back(list[j]);
        }
      }
      body().n_input++;
    }
  }
};

/* An operation again, where it may be folded. */
static number again(const node &n, number a, number b, number c)
{
  if (n.op == '?') {
    return !node_of(a) ? (a.d != 0 ? b : c) : bits(b) == bits(c) ? b : make('?', a, b, c);
  }
  if (std::strchr("<l=", n.op)) {
    return node_of(a) || node_of(b) ? make(n.op, a, b, 0.0) : number(evaluate(n.op, value(a), value(b), 0.0));
  }
  return apply(n.op, a, b);
}

/* Loop `at` as one iteration for all; false: they are not alike. */
static bool roll(const history &h, int at)
{
  roller r(h, at);
  std::vector<int> slots; /* of the operands one after the other */
  auto take = [&](std::size_t i, number node::*member) {
    int slot_of;
    const bool fits =
        r.take([&](int j) { return h.of.nodes[(std::size_t)h.list[(std::size_t)j][i]].*member; }, slot_of);
    slots.push_back(slot_of);
    return fits;
  };
  auto take_guard = [&](std::size_t k, number guard::*member) {
    int slot_of;
    const bool fits =
        r.take([&](int j) { return h.of.guards[(std::size_t)h.guards[(std::size_t)j][k]].*member; }, slot_of);
    slots.push_back(slot_of);
    return fits;
  };
  const bool empty = h.trips() == 0 || (h.list[0].empty() && h.guards[0].empty());
  if (empty || h.trips() / h.lanes < 2 || !h.are_alike()) {
    return false;
  }
  for (std::size_t i = 0; i < h.list[0].size(); i++) {
    if (!take(i, &node::a) || !take(i, &node::b) || !take(i, &node::c)) {
      return false;
    }
  }
  for (std::size_t k = 0; k < h.guards[0].size(); k++) {
    if (!take_guard(k, &guard::a) || !take_guard(k, &guard::b)) {
      return false;
    }
  }
  for (bool changed = true; changed;) {
    std::size_t next_slot = 0, next_guard = 0;
    auto operand = [&](number own) {
      const int s = slots[next_slot++];
      return s < 0 ? r.stand[(std::size_t)h.place[(std::size_t)node_of(own)]] : r.inputs[(std::size_t)s];
    };
    std::vector<guard> guards;
    r.begin();
    for (std::size_t i = 0; i < h.list[0].size(); i++) {
      const node &n = h.of.nodes[(std::size_t)h.list[0][i]];
      const number a = operand(n.a), b = operand(n.b), c = operand(n.c);
      for (; next_guard < h.guards[0].size() && h.before(h.of.guards[(std::size_t)h.guards[0][next_guard]]) <= (int)i;
           next_guard++) {
        guards.push_back(h.of.guards[(std::size_t)h.guards[0][next_guard]]);
        guards.back().after = (int)r.body().nodes.size() - 1;
      }
      r.stand.push_back(again(n, a, b, c));
    }
    for (; next_guard < h.guards[0].size(); next_guard++) {
      guards.push_back(h.of.guards[(std::size_t)h.guards[0][next_guard]]);
      guards.back().after = (int)r.body().nodes.size() - 1;
    }
    for (guard &c : guards) {
      c.a = operand(c.a);
      c.b = operand(c.b);
    }
    r.body().guards = guards;

    /* what is carried and never changes stays */
    changed = false;
    for (std::size_t s = 0; s < r.lists.size(); s++) {
      if (r.carried(s) >= 0) {
        const number next = r.stand[(std::size_t)r.carried(s)];
        r.body().feeds[(std::size_t)r.body().nodes[(std::size_t)node_of(r.inputs[s])].a.d].next = next;
        bool same = bits(next) == bits(r.inputs[s]);
        if (!node_of(next)) {
          const std::vector<number> &list = r.lists[s];
          same =
              bits(next) == bits(list[0]) && bits(next) == bits(list[list.size() - list.size() / (std::size_t)h.lanes]);
        }
        if (same) {
          r.stay(s);
          changed = true;
        }
      }
    }
  }
  r.body().trips = h.trips();
  for (std::size_t i = 0; i < h.of.nodes.size(); i++) {
    const int place = h.place[i];
    r.body().stands.push_back(
        {place < 0 ? number(0) : r.stand[(std::size_t)place], h.iteration[i], h.of.nodes[i].value});
  }
  return true;
}

/* The operations of loop `at` in its parent, one after the other. */
static void unroll(const history &h, int at)
{
  graph g;
  g.name = h.of.name;
  g.loops = true;
  g.parent = h.of.parent;
  g.stands.assign(h.of.nodes.size(), {number(0), 0, 0.0});
  auto of = [&](number a) {
    const number outer = h.outer(a);
    return node_of(a) && bits(outer) == bits(a) ? g.stands[(std::size_t)node_of(a)].what : outer;
  };
  std::size_t next = 0;
  for (std::size_t i = 1; i <= h.of.nodes.size(); i++) {
    for (; next < h.of.guards.size() && h.of.guards[next].after < (int)i; next++) {
      guard c = h.of.guards[next];
      c.a = of(c.a), c.b = of(c.b);
      c.after = (int)here().nodes.size() - 1;
      if (node_of(c.a) || node_of(c.b)) {
        here().guards.push_back(c);
      }
    }
    if (i < h.of.nodes.size() && h.place[i] >= 0) {
      const node &n = h.of.nodes[i];
      g.stands[i] = {again(n, of(n.a), of(n.b), of(n.c)), 0, n.value};
    }
  }
  R.all[(std::size_t)at] = g;
}

void loop_end()
{
  const int at = R.now, parent = here().parent;
  const graph recorded = here();
  const history h(recorded);
  bool alike = false;
  for (history::cut by : {history::PAIRS, history::SUMS, history::HALVES}) {
    history divided = h;
    alike = alike || (recorded.pairs && divided.divide(by) && roll(divided, at));
  }
  alike = alike || roll(h, at);
  R.now = parent;
  if (!alike) {
    unroll(h, at);
  }
  R.all[(std::size_t)at].open = false;
  if (alike) {
    R.all[(std::size_t)at].kind = kind_of(R.all[(std::size_t)at]);
    R.all[(std::size_t)at].call = node_of(push(parent, {'l', at, 0, 0, 0.0}));
  }
}

} // namespace trace
#endif
