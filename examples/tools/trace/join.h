/* join.h - loops of a graph whose iterations need nothing but their own of each other as one loop: what the first leaves for
   the second stands in no array. */
#ifndef TRACE_JOIN_H
#define TRACE_JOIN_H
#include "graph.h"

namespace trace
{

struct joining {
  const int at; /* the graph in the recording */
  const std::vector<char> live;
  const std::vector<unsigned> zero; /* inputs without which nodes are zero */

  const graph &own() const
  {
    return R.all[(std::size_t)at];
  }

  const node &of(int i) const
  {
    return own().nodes[(std::size_t)i];
  }

  const graph &loop_of(int i) const
  {
    return R.all[(std::size_t)of(i).a.d];
  }

  /* A loop that checks nothing and whose iterations do not follow from each other: compilers compute several at once. */
  bool is_parallel(int i) const
  {
    if (!live[(std::size_t)i] || of(i).op != 'l') {
      return false;
    }
    const graph &l = loop_of(i);
    auto is_carried = [](const feed &s) { return s.is == feed::CARRIED; };
    return l.lanes == 1 && !checks_anything(l) && std::none_of(l.feeds.begin(), l.feeds.end(), is_carried);
  }

  /* Nodes that follow from node `first`. */
  std::vector<char> followers(int first) const
  {
    std::vector<char> follows(own().nodes.size(), 0);
    follows[(std::size_t)first] = 1;
    for (int i = first + 1; i < (int)follows.size(); i++) {
      for (number a : is_call(of(i)) ? loop_of(i).arguments : operands(own(), of(i))) {
        follows[(std::size_t)i] |= follows[(std::size_t)node_of(a)];
      }
    }
    return follows;
  }

  /* Can a number be known at node `first` without a call behind it? */
  bool is_known_at(int first, number a) const
  {
    if (node_of(a) < first) {
      return true;
    }
    const node &n = of(node_of(a));
    bool known = !is_call(n) && n.op != 'v';
    for (number x : operands(own(), n)) {
      known = known && is_known_at(first, x);
    }
    return known;
  }

  /* The node of loop `first` whose results are the list, iteration by iteration; 0: they are something else. */
  int handed_on(int first, const graph &l, const feed &s) const
  {
    int result = 0;
    for (int k = 0; k < l.trips; k++) {
      const number a = l.arguments[(std::size_t)(s.first + k)];
      const node &n = of(node_of(a));
      const bool fits = s.is == feed::LISTED && n.op == 'r' && node_of(n.a) == first && (int)n.c.d == k &&
                        (k == 0 || (int)n.b.d == result);
      if (!fits) {
        return 0;
      }
      result = (int)n.b.d;
    }
    return result;
  }

  /* Can loop `second` be done where `first` is, iteration by iteration? */
  bool fit(int first, int second) const
  {
    const graph &l = loop_of(second);
    if (loop_of(first).trips != l.trips || zero[(std::size_t)first] != zero[(std::size_t)second]) {
      return false;
    }
    const std::vector<char> follows = followers(first), needed = needed_in(l, live);
    for (std::size_t i = 1; i < l.nodes.size(); i++) {
      if (!needed[i] || l.nodes[i].op != 'i') {
        continue;
      }
      const feed &s = l.feeds[(std::size_t)l.nodes[i].a.d];
      for (int k = 0; k < arguments_of(l, s) && !handed_on(first, l, s); k++) {
        const number a = l.arguments[(std::size_t)(s.first + k)];
        if (node_of(a) && (follows[(std::size_t)node_of(a)] || !is_known_at(first, a))) {
          return false;
        }
      }
    }
    return true;
  }

  /* Input of the joined body with these arguments. */
  static number input_of(int body, const feed &s, const std::vector<number> &arguments)
  {
    graph &l = R.all[(std::size_t)body];
    auto same = [](number a, number b) { return bits(a) == bits(b); };
    for (std::size_t i = 1; i < l.nodes.size(); i++) {
      if (l.nodes[i].op == 'i') {
        const feed &other = l.feeds[(std::size_t)l.nodes[i].a.d];
        if (other.is == s.is &&
            std::equal(arguments.begin(), arguments.end(), l.arguments.begin() + other.first, same)) {
          return number_of(body, (int)i);
        }
      }
    }
    const int index = (int)l.feeds.size();
    l.feeds.push_back({s.is, (int)l.arguments.size(), 0});
    l.arguments.insert(l.arguments.end(), arguments.begin(), arguments.end());
    l.n_input++;
    return push(body, {'i', index, 0, 0, value(arguments[0])});
  }

  /* Loop `second` as part of `first`. */
  void join(int first, int second)
  {
    const int body = (int)of(first).a.d;
    const graph l = loop_of(second), before = loop_of(first);
    std::vector<number> now(l.nodes.size(), 0.0);
    std::map<content, number> known;
    auto at_last = [&](number a) { return node_of(a) ? now[(std::size_t)node_of(a)] : a; };
    for (std::size_t i = 1; i < before.nodes.size(); i++) {
      const node &n = before.nodes[i];
      known[content(n.op, bits(n.a), bits(n.b), bits(n.c))] = number_of(body, (int)i);
    }
    const std::vector<char> needed = needed_in(l, live);
    std::vector<char> is_result(l.nodes.size(), 0); /* has a name of its own */
    for (const auto &r : l.results) {
      is_result[(std::size_t)r.first % l.nodes.size()] = 1;
    }
    for (std::size_t i = 1; i < l.nodes.size(); i++) {
      const node &n = l.nodes[i];
      if (!needed[i]) {
        continue;
      }
      if (n.op == 'i') {
        const feed &s = l.feeds[(std::size_t)n.a.d];
        const int handed = handed_on(first, l, s);
        const auto begin = l.arguments.begin() + s.first;
        now[i] = handed ? number_of(body, handed)
                        : input_of(body, s, std::vector<number>(begin, begin + arguments_of(l, s)));
        continue;
      }
      const number a = at_last(n.a), b = at_last(n.b), c = at_last(n.c);
      number &same = known[content(n.op, bits(a), bits(b), bits(c))];
      same = node_of(same) && !is_result[i] ? same : push(body, {n.op, a, b, c, n.value});
      now[i] = same;
    }
    rename_results(first, second, before, l, now);
  }

  void rename_results(int first, int second, const graph &before, const graph &l, const std::vector<number> &now)
  {
    const int body = (int)of(first).a.d;
    graph &joined = R.all[(std::size_t)body], &parent = R.all[(std::size_t)at];
    joined.results.clear();
    for (const auto &r : before.results) {
      const int size = (int)before.nodes.size();
      joined.results[place_of(joined, r.first / size, r.first % size)] = r.second;
    }
    for (const auto &r : l.results) {
      const int size = (int)l.nodes.size(), made = node_of(now[(std::size_t)(r.first % size)]);
      if (live[(std::size_t)r.second]) {
        joined.results[place_of(joined, r.first / size, made)] = r.second;
        parent.nodes[(std::size_t)r.second].a = number_of(at, first);
        parent.nodes[(std::size_t)r.second].b = made;
      }
    }
    parent.nodes[(std::size_t)second] = {'.', 0, 0, 0, 0.0};
  }

  void join_all()
  {
    for (int second = 2; second < (int)own().nodes.size(); second++) {
      bool joined = !is_parallel(second);
      for (int first = second - 1; first > 0 && !joined; first--) {
        if (is_parallel(first) && fit(first, second)) {
          join(first, second);
          joined = true;
        }
      }
    }
  }
};

} // namespace trace
#endif
