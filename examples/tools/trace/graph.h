/* graph.h - the operations that the library has made of inputs, and the comparisons on which it has branched. */
#ifndef TRACE_GRAPH_H
#define TRACE_GRAPH_H
#include "number.h"
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace trace
{

struct node {
  char op;
  number a, b, c;
  double value; /* where the graph was made */
};

/* A comparison of numbers that depend on inputs: what is written holds where it has the same outcome. Elsewhere the
   library does something else, which is found by running it again with this outcome turned round: it returns a status
   (a check), leaves the same graph (the comparison decides nothing), or another one (a branch). */
struct guard {
  char relation;
  number a, b;
  bool outcome;
  int after;  /* the last node before it */
  int status; /* of the library elsewhere; BRANCH: it goes on otherwise */
  std::string what;
};

enum { BRANCH = 100 };

struct graph {
  std::vector<node> nodes{1}; /* [0] is none */
  std::vector<guard> guards;
  std::map<std::tuple<char, std::uint64_t, std::uint64_t, std::uint64_t>, int> known, asked;
  bool recording = false;
  int turned = -1;     /* the guard whose outcome is turned round */
  int conversions = 0; /* to int, of numbers that depend on inputs */
  int n_input = 0;
};

static graph G;

static double value(number a)
{
  return node_of(a) ? G.nodes[(std::size_t)node_of(a)].value : a.d;
}

number::operator double() const
{
  return value(*this);
}

number::operator int() const
{
  G.conversions += node_of(*this) > 0;
  return (int)value(*this);
}

static double evaluate(char op, double a, double b, double c)
{
  switch (op) {
  case '+':
    return a + b;
  case '-':
    return a - b;
  case '*':
    return a * b;
  case '/':
    return a / b;
  case 'n':
    return -a;
  case 'q':
    return std::sqrt(a);
  case 's':
    return std::sin(a);
  case 'c':
    return std::cos(a);
  case 't':
    return std::atan2(a, b);
  case 'f':
    return std::fabs(a);
  case 'e':
    return std::exp(a);
  case '<':
    return a < b;
  case 'l':
    return a <= b;
  case '=':
    return a == b;
  default:
    return a != 0.0 ? b : c;
  }
}

static number make(char op, number a, number b, number c)
{
  const auto key = std::make_tuple(op, bits(a), bits(b), bits(c));
  const auto found = G.known.find(key);
  if (found != G.known.end()) {
    return number_of(found->second);
  }
  G.nodes.push_back({op, a, b, c, evaluate(op, value(a), value(b), value(c))});
  G.known[key] = (int)G.nodes.size() - 1;
  return number_of((int)G.nodes.size() - 1);
}

static bool is(number a, double x)
{
  return !node_of(a) && a.d == x;
}

/* x of a node -x, else 0 */
static number negative_of(number a)
{
  const node &n = G.nodes[(std::size_t)node_of(a)];
  return node_of(a) && n.op == 'n' ? n.a : number(0);
}

/* What leaves the bits of the result as they are, but for the sign of zero. */
number apply(char op, number a, number b)
{
  const int constant = !node_of(a) && !node_of(b);
  if (constant || !G.recording) {
    return evaluate(op, value(a), value(b), 0.0);
  }
  if (op == '*' && (is(a, 0.0) || is(b, 0.0))) {
    return 0.0;
  }
  if ((op == '+' && is(a, 0.0)) || (op == '*' && is(a, 1.0))) {
    return b;
  }
  if (((op == '+' || op == '-') && is(b, 0.0)) || ((op == '*' || op == '/') && is(b, 1.0))) {
    return a;
  }
  if (op == '/' && is(a, 0.0)) {
    return 0.0;
  }
  if ((op == '*' && is(a, -1.0)) || (op == '-' && is(a, 0.0))) {
    return apply('n', b);
  }
  if (op == '*' && is(b, -1.0)) {
    return apply('n', a);
  }
  const number minus_a = negative_of(a), minus_b = negative_of(b); /* signs go outward: a + (-b) is a - b */
  if (op == 'n' && node_of(minus_a)) {
    return minus_a;
  }
  if (op == '+' && node_of(minus_b)) {
    return apply('-', a, minus_b);
  }
  if (op == '+' && node_of(minus_a)) {
    return apply('-', b, minus_a);
  }
  if (op == '-' && node_of(minus_b)) {
    return apply('+', a, minus_b);
  }
  if ((op == '*' || op == '/') && (node_of(minus_a) || node_of(minus_b))) {
    const number product = apply(op, node_of(minus_a) ? minus_a : a, node_of(minus_b) ? minus_b : b);
    return node_of(minus_a) && node_of(minus_b) ? product : apply('n', product);
  }
  if (op == '*' && !node_of(a) && a.d < 0.0) { /* of constants likewise */
    return apply('n', apply('*', -a.d, b));
  }
  if (op == '*' && !node_of(b) && b.d < 0.0) {
    return apply('n', apply('*', a, -b.d));
  }
  if ((op == '+' || op == '*') && bits(a) > bits(b)) { /* a + b is b + a */
    return make(op, b, a, 0.0);
  }
  return make(op, a, b, 0.0);
}

number select(char relation, number a, number b, number yes, number no)
{
  if ((!node_of(a) && !node_of(b)) || !G.recording) {
    return evaluate(relation, value(a), value(b), 0.0) != 0.0 ? yes : no;
  }
  return bits(yes) == bits(no) ? yes : make('?', make(relation, a, b, 0.0), yes, no);
}

bool ask(char relation, number a, number b)
{
  bool outcome = evaluate(relation, value(a), value(b), 0.0) != 0.0;
  if ((!node_of(a) && !node_of(b)) || !G.recording) {
    return outcome;
  }
  const auto key = std::make_tuple(relation, bits(a), bits(b), std::uint64_t(0));
  const auto found = G.asked.find(key);
  if (found != G.asked.end()) {
    return G.guards[(std::size_t)found->second].outcome;
  }
  outcome = (int)G.guards.size() == G.turned ? !outcome : outcome;
  G.asked[key] = (int)G.guards.size();
  G.guards.push_back({relation, a, b, outcome, (int)G.nodes.size() - 1, 0, ""});
  return outcome;
}

static number input(double x)
{
  G.nodes.push_back({'i', G.n_input++, 0, 0, x});
  return number_of((int)G.nodes.size() - 1);
}

static void begin(int turned)
{
  G = graph();
  G.turned = turned;
  G.recording = true;
}

/* What stands for all that a number is made of, the same in every graph. */
static std::vector<std::uint64_t> contents()
{
  std::vector<std::uint64_t> all(G.nodes.size(), 0);
  for (std::size_t i = 1; i < all.size(); i++) {
    const node &n = G.nodes[i];
    std::uint64_t sum = (std::uint64_t)n.op;
    for (number a : {n.a, n.b, n.c}) {
      sum = (sum ^ (node_of(a) ? all[(std::size_t)node_of(a)] : bits(a))) * 0x9E3779B97F4A7C15ull;
      sum ^= sum >> 29;
    }
    all[i] = sum;
  }
  return all;
}

/* Results, and the comparisons but for number `left_out`, as contents. */
static std::vector<std::uint64_t> gist(const std::vector<number> &results, int left_out)
{
  const std::vector<std::uint64_t> all = contents();
  std::vector<std::uint64_t> list;
  auto add = [&](number a) { list.push_back(node_of(a) ? all[(std::size_t)node_of(a)] : bits(a)); };
  for (number r : results) {
    add(r);
  }
  for (std::size_t k = 0; k < G.guards.size(); k++) {
    if ((int)k != left_out) {
      list.push_back((std::uint64_t)G.guards[k].relation);
      add(G.guards[k].a), add(G.guards[k].b);
    }
  }
  return list;
}

/* The values of all nodes at other inputs; returns the status of the first guard that does not hold, 0: all do. */
static int values_at(std::vector<double> &v, const std::vector<double> &inputs)
{
  auto at = [&](number a) { return node_of(a) ? v[(std::size_t)node_of(a)] : a.d; };
  std::size_t g = 0;
  v.assign(G.nodes.size(), 0.0);
  for (std::size_t i = 1; i <= G.nodes.size(); i++) {
    for (; g < G.guards.size() && G.guards[g].after < (int)i; g++) {
      const guard &c = G.guards[g];
      if (c.status != 0 && (evaluate(c.relation, at(c.a), at(c.b), 0.0) != 0.0) != c.outcome) {
        return c.status;
      }
    }
    if (i < G.nodes.size()) {
      const node &n = G.nodes[i];
      v[i] = n.op == 'i' ? inputs[(std::size_t)n.a.d] : evaluate(n.op, at(n.a), at(n.b), at(n.c));
    }
  }
  return 0;
}

/* Marks what is needed for the results and, with checks, for the guards. */
static std::vector<char> needed(const std::vector<number> &results, bool checks)
{
  std::vector<char> live(G.nodes.size(), 0);
  auto mark = [&](number a) { live[(std::size_t)node_of(a)] = 1; };
  for (number r : results) {
    mark(r);
  }
  for (const guard &c : G.guards) {
    if (c.status != 0 && checks) {
      mark(c.a), mark(c.b);
    }
  }
  for (std::size_t i = G.nodes.size() - 1; i > 0; i--) {
    if (live[i] && G.nodes[i].op != 'i') {
      mark(G.nodes[i].a), mark(G.nodes[i].b), mark(G.nodes[i].c);
    }
  }
  return live;
}

/* ---- derivatives, appended to the graph */

typedef std::map<int, number> gradient; /* by node, or by input */

/* d(node)/d(operand) of node i, by operand. */
static gradient partials_of(int i)
{
  const node n = G.nodes[(std::size_t)i]; /* a copy: nodes are appended */
  const number self = number_of(i);
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
  const std::vector<char> live = needed(results, false);
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
      if (G.nodes[on].op == 'i' || !of[on].empty()) { /* else it is a sign: constant, but for where it jumps */
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
    if (G.nodes[i].op == 'i') {
      g[(int)G.nodes[i].a.d] = 1.0;
    }
    for (const auto &e : of[i]) {
      if (kept[(std::size_t)e.first] && G.nodes[(std::size_t)e.first].op != 'i') {
        for (const auto &inner : done[e.first]) {
          add(inner.first, e.second * inner.second);
        }
      } else {
        add((int)G.nodes[(std::size_t)e.first].a.d, e.second);
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
