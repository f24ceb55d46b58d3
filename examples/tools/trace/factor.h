/* factor.h - common factors of sums, taken out: a b + a c becomes a (b + c), and quotients by one divisor become products
   with its reciprocal. The numbers differ from the library's by rounding afterwards; sums that live on rounding stay as
   they are: those that cancel, and those with an indicator among their factors (1 where a < b, else 0). */
#ifndef TRACE_FACTOR_H
#define TRACE_FACTOR_H
#include "graph.h"
#include <algorithm>
#include <limits>

namespace trace
{

struct factoring {
  graph old;
  int at; /* the graph in the recording */
  const read_arguments &read;
  std::vector<number> now; /* its nodes, as they are called in the new one */
  std::vector<char> live, absorbed;
  std::vector<int> uses, quotients; /* by divisor */

  struct term {
    bool minus;
    std::vector<number> factors; /* in the new graph; constants are above zero */
  };

  static bool is_sum(char op)
  {
    return op == '+' || op == '-' || op == 'n';
  }

  const node &of(number a) const
  {
    return old.nodes[(std::size_t)node_of(a)];
  }

  /* A number that nothing else uses, of one of these operations. */
  bool is_single(number a, const char *ops) const
  {
    return node_of(a) && uses[(std::size_t)node_of(a)] == 1 && std::strchr(ops, of(a).op);
  }

  bool is_read(const graph &inner, std::size_t argument) const
  {
    const auto found = read.find(inner.kind);
    return found != read.end() && found->second[argument];
  }

  number known(number a) const
  {
    return node_of(a) ? now[(std::size_t)node_of(a)] : a;
  }

  bool is_shared_divisor(number a) const
  {
    return node_of(a) && quotients[(std::size_t)node_of(a)] > 1;
  }

  /* Whether i stands in no larger sum or product. */
  void absorb(number a, bool in_sum)
  {
    if (is_single(a, in_sum ? "+-n*" : "*n")) {
      absorbed[(std::size_t)node_of(a)] = 1;
    }
  }

  void add_factor(term &t, number a) const
  {
    if (is_single(a, "*n")) {
      t.minus = t.minus != (of(a).op == 'n');
      add_factor(t, of(a).a);
      if (of(a).op == '*') {
        add_factor(t, of(a).b);
      }
      return;
    }
    number x = known(a);
    if (!node_of(x) && x.d < 0.0) {
      t.minus = !t.minus;
      x = -x.d;
    }
    t.factors.push_back(x);
  }

  void add_terms(std::vector<term> &terms, number a, bool minus, bool root) const
  {
    if (root || is_single(a, "+-n")) {
      const node &n = of(a);
      add_terms(terms, n.a, minus != (n.op == 'n'), false);
      if (n.op != 'n') {
        add_terms(terms, n.b, minus != (n.op == '-'), false);
      }
      return;
    }
    term t = {minus, {}};
    add_factor(t, a);
    terms.push_back(t);
  }

  static number product(std::vector<number> factors)
  {
    double c = 1.0;
    std::sort(factors.begin(), factors.end(), [](number a, number b) { return bits(a) < bits(b); });
    number x = 1.0;
    for (number f : factors) {
      if (node_of(f)) {
        x = x * f;
      } else {
        c *= f.d;
      }
    }
    c = std::fabs(c - 1.0) < 4.0 * std::numeric_limits<real>::epsilon() ? 1.0 : c;
    return number(c) * x;
  }

  static double value_of(const term &t)
  {
    double x = t.minus ? -1.0 : 1.0;
    for (number f : t.factors) {
      x *= value(f);
    }
    return x;
  }

  /* 1 or 0; a product of these, too. */
  static bool is_indicator(number a)
  {
    return node_of(a) && (std::strchr("<l=", node_at(a).op) ||
                          (node_at(a).op == '?' && !node_of(node_at(a).b) && !node_of(node_at(a).c)) ||
                          (node_at(a).op == '*' && is_indicator(node_at(a).a) && is_indicator(node_at(a).b)));
  }

  /* Sums that rounding is all of, and those of indicators. */
  static bool lives_on_rounding(const std::vector<term> &terms)
  {
    double sum = 0.0, most = 0.0;
    for (const term &t : terms) {
      sum += value_of(t);
      most = std::fmax(most, std::fabs(value_of(t)));
      for (number f : t.factors) {
        if (is_indicator(f)) {
          return true;
        }
      }
    }
    return std::fabs(sum) < 1e-4 * most;
  }

  /* The factor of most terms, and of how many. */
  static int most_frequent(const std::vector<term> &terms, number &factor)
  {
    std::unordered_map<std::uint64_t, int> count;
    int most = 1;
    for (const term &t : terms) {
      std::set<std::uint64_t> own;
      for (number f : t.factors) {
        if (!is(f, 1.0) && own.insert(bits(f)).second && ++count[bits(f)] > most) {
          most = count[bits(f)];
          factor = f;
        }
      }
    }
    return most;
  }

  /* In one order and with one sign, so that sums of the same terms are one. */
  static number ordered_sum(const std::vector<term> &terms)
  {
    std::vector<std::pair<std::uint64_t, bool>> list;
    for (const term &t : terms) {
      number x = product(t.factors);
      const bool minus = node_of(negative_of(x));
      list.push_back({bits(minus ? negative_of(x) : x), t.minus != minus});
    }
    std::sort(list.begin(), list.end());
    const bool turned = list[0].second;
    number sum = 0.0;
    for (const auto &t : list) {
      number x;
      std::memcpy(&x, &t.first, sizeof x);
      sum = t.second != turned ? sum - x : sum + x;
    }
    return turned ? -sum : sum;
  }

  static number sum_of(std::vector<term> terms)
  {
    number factor = 0.0, sum = 0.0;
    if (most_frequent(terms, factor) > 1) {
      std::vector<term> with, without;
      for (term &t : terms) {
        const auto found =
            std::find_if(t.factors.begin(), t.factors.end(), [&](number f) { return bits(f) == bits(factor); });
        if (found != t.factors.end()) {
          t.factors.erase(found);
          with.push_back(t);
        } else {
          without.push_back(t);
        }
      }
      sum = factor * sum_of(with);
      return without.empty() ? sum : sum + sum_of(without);
    }
    return ordered_sum(terms);
  }

  number rewritten(int i) const
  {
    const node &n = old.nodes[(std::size_t)i];
    if (n.op == 'm') {
      return of_model((int)n.a.d, n.value);
    }
    if (n.op == 'v') {
      for (number &a : R.all[(std::size_t)at].lists[(std::size_t)n.a.d]) {
        a = known(a);
      }
    }
    if (std::strchr("ikrv", n.op)) {
      const number a = n.op == 'r' ? known(n.a) : n.a;
      return push(at, {n.op, a, n.b, n.c, n.value});
    }
    if (is_sum(n.op)) {
      std::vector<term> terms;
      add_terms(terms, number_of(at, i), false, true);
      if (!lives_on_rounding(terms)) {
        return sum_of(terms);
      }
    }
    if (n.op == '*') {
      term t = {false, {}};
      add_factor(t, n.a), add_factor(t, n.b);
      return t.minus ? -product(t.factors) : product(t.factors);
    }
    if (n.op == '/' && is_shared_divisor(n.b)) {
      return copy(n.a) * (number(1.0) / copy(n.b));
    }
    const number a = copy(n.a), b = copy(n.b);
    if (n.op == 'q' && node_of(a) && node_at(a).op == '*' && bits(node_at(a).a) == bits(node_at(a).b)) {
      return apply('f', node_at(a).a);
    }
    if (n.op == '?') {
      return make('?', a, b, copy(n.c));
    }
    return std::strchr("<l=", n.op) ? make(n.op, a, b, 0.0) : apply(n.op, a, b);
  }

  /* As it was, where a sum keeps its order. */
  number copy(number a) const
  {
    return node_of(a) && absorbed[(std::size_t)node_of(a)] ? rewritten_as_it_was(a) : known(a);
  }

  number rewritten_as_it_was(number a) const
  {
    const node &n = of(a);
    return apply(n.op, copy(n.a), copy(n.b));
  }

  factoring(int graph_at, const std::vector<number> &results, const read_arguments &of_kernels)
      : old(R.all[(std::size_t)graph_at]), at(graph_at), read(of_kernels)
  {
    const std::size_t n = old.nodes.size();
    graph &g = R.all[(std::size_t)at];
    live = needed(old, results, true, &read);
    now.assign(n, 0.0);
    absorbed.assign(n, 0);
    uses.assign(n, 0);
    quotients.assign(n, 0);
    count_uses(results);
    for (std::size_t i = 1; i < n; i++) {
      const node &own = old.nodes[i];
      if (live[i] && is_sum(own.op)) {
        absorb(own.a, true), absorb(own.b, true);
      } else if (live[i] && own.op == '*') {
        absorb(own.a, false), absorb(own.b, false);
      }
    }
    g.nodes.resize(1);
    g.known.clear();
    R.now = at;
    R.on = true;
    R.kernels = false;
    std::size_t next = 0;
    for (std::size_t i = 1; i <= n; i++) {
      for (; next < old.guards.size() && old.guards[next].after < (int)i; next++) {
        guard &c = g.guards[next];
        if (c.status != 0) {
          c.a = known(c.a), c.b = known(c.b);
        }
        c.after = (int)R.all[(std::size_t)at].nodes.size() - 1;
      }
      if (i == n) {
        break;
      }
      if (live[i] && !absorbed[i]) {
        if (old.nodes[i].op == 'k') {
          graph &inner = R.all[(std::size_t)old.nodes[i].a.d];
          for (std::size_t a = 0; a < inner.arguments.size(); a++) {
            inner.arguments[a] = is_read(inner, a) ? known(inner.arguments[a]) : number(0.0);
          }
        }
        now[i] = rewritten((int)i);
      }
    }
    R.on = false;
  }

  void count_uses(const std::vector<number> &results)
  {
    auto use = [&](number a) { uses[(std::size_t)node_of(a)]++; };
    for (std::size_t i = 1; i < old.nodes.size(); i++) {
      const node &n = old.nodes[i];
      if (live[i] && n.op == 'k') {
        const graph &inner = R.all[(std::size_t)n.a.d];
        for (std::size_t a = 0; a < inner.arguments.size(); a++) {
          use(is_read(inner, a) ? inner.arguments[a] : number(0.0));
        }
      } else if (live[i]) {
        for (number a : operands(old, n)) {
          use(a);
        }
        quotients[(std::size_t)(n.op == '/' ? node_of(n.b) : 0)]++;
      }
    }
    for (number r : results) {
      use(r);
    }
    for (const guard &c : old.guards) {
      if (c.status != 0) {
        use(c.a), use(c.b);
      }
    }
  }
};

/* Factors a graph of R; results become those of the new graph. */
static void factor(int graph_at, std::vector<number> &results, const read_arguments &read)
{
  for (int round = 0; round < 2; round++) {
    const factoring f(graph_at, results, read);
    for (number &r : results) {
      r = f.known(r);
    }
  }
}

} // namespace trace
#endif
