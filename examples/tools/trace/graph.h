/* graph.h - the operations that the library has made of inputs, and the comparisons on which it has branched. A part of
   the library that is marked as a kernel (FB_KERNEL) has a graph of its own at each call: what it uses of the graphs
   around it are its arguments, what they use of it afterwards its results. */
#ifndef TRACE_GRAPH_H
#define TRACE_GRAPH_H
#include "number.h"
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <unordered_map>
#include <vector>

namespace trace
{

#if FB_SINGLE
typedef float real;
#else
typedef double real;
#endif

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
  int order;  /* among all of a recording */
  int status; /* of the library elsewhere; BRANCH: it goes on otherwise */
  std::string what;
};

enum { BRANCH = 100 };

typedef std::tuple<char, std::uint64_t, std::uint64_t, std::uint64_t> content;

struct content_hash {
  std::size_t operator()(const content &c) const
  {
    std::uint64_t sum = (std::uint64_t)std::get<0>(c);
    for (std::uint64_t x : {std::get<1>(c), std::get<2>(c), std::get<3>(c)}) {
      sum = (sum ^ x) * 0x9E3779B97F4A7C15ull;
      sum ^= sum >> 29;
    }
    return (std::size_t)sum;
  }
};

/* A number in memory that a kernel takes from one turn of a loop to the next (FB_CARRY). */
struct slot {
  number *at, before, own, after, left; /* before, left: of the parent; own, after: of the kernel */
};

struct graph {
  std::vector<node> nodes{1}; /* [0] is none */
  std::vector<guard> guards;
  std::unordered_map<content, int, content_hash> known, asked;
  int n_input = 0;

  /* of a kernel */
  std::string name;
  std::uint64_t kind = 0;        /* that of kernels with the same operations */
  int parent = -1, call = 0;     /* the graph that calls it, the node there once it has returned */
  bool open = true;              /* still running */
  std::vector<number> arguments; /* of the parent */
  std::unordered_map<std::uint64_t, int> captured;
  std::map<int, int> results; /* its node: that of the parent */
  std::vector<int> apart;     /* kinds of rows: its results come of the library's own text (apart.h) */
  std::vector<slot> slots;
};

struct recording {
  std::vector<graph> all; /* [0] is the outermost */
  int now = 0;            /* the graph that is running */
  bool on = false, kernels = false;
  int turned = -1;     /* the guard whose outcome is turned round */
  int n_asked = 0;     /* guards */
  int conversions = 0; /* to int, of numbers that depend on inputs */
};

static recording R;

bool is_recording()
{
  return R.on;
}

/* Which slots of a kernel are the same number in every turn, by the name of the kernel: found by a recording, used by the
   next one. */
static std::map<std::string, std::vector<char>> still;

static graph &here()
{
  return R.all[(std::size_t)R.now];
}

static const node &node_at(number a)
{
  return R.all[(std::size_t)graph_of(a)].nodes[(std::size_t)node_of(a)];
}

static double value(number a)
{
  return node_of(a) ? node_at(a).value : (double)(real)a.d;
}

number::operator double() const
{
  return value(*this);
}

number::operator int() const
{
  R.conversions += node_of(*this) > 0;
  return (int)value(*this);
}

static double evaluate(char op, double x, double y, double z)
{
  const real a = (real)x, b = (real)y, c = (real)z;
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
  case 'z':
    return (real)(int)a;
  case '<':
    return a < b;
  case 'l':
    return a <= b;
  case '=':
    return a == b;
  default:
    return a != 0 ? b : c;
  }
}

static number push(int graph_at, const node &n)
{
  graph &g = R.all[(std::size_t)graph_at];
  g.nodes.push_back(n);
  return number_of(graph_at, (int)g.nodes.size() - 1);
}

static number make(char op, number a, number b, number c)
{
  const content key(op, bits(a), bits(b), bits(c));
  const auto found = here().known.find(key);
  if (found != here().known.end()) {
    return number_of(R.now, found->second);
  }
  const number made = push(R.now, {op, a, b, c, evaluate(op, value(a), value(b), value(c))});
  here().known[key] = node_of(made);
  return made;
}

/* ---- kernels */

static number input(double x)
{
  const int index = here().n_input++;
  return push(R.now, {'i', index, 0, 0, x});
}

/* A number of the kernel's parent as its argument. */
static number capture(number a, int kernel)
{
  graph &g = R.all[(std::size_t)kernel];
  const auto found = g.captured.find(bits(a));
  if (found != g.captured.end()) {
    return number_of(kernel, found->second);
  }
  g.arguments.push_back(a);
  const number made = push(kernel, {'i', g.n_input++, 0, 0, value(a)});
  g.captured[bits(a)] = node_of(made);
  return made;
}

/* A number of a kernel that has returned, as its parent has it. */
static number result(number a)
{
  graph &g = R.all[(std::size_t)graph_of(a)];
  const node &n = g.nodes[(std::size_t)node_of(a)];
  if (n.op == 'i') {
    return g.arguments[(std::size_t)n.a.d];
  }
  const auto found = g.results.find(node_of(a));
  if (found != g.results.end()) {
    return number_of(g.parent, found->second);
  }
  const number made = push(g.parent, {'r', number_of(g.parent, g.call), node_of(a), 0, n.value});
  R.all[(std::size_t)graph_of(a)].results[node_of(a)] = node_of(made);
  return made;
}

/* The same number in the graph that is running; a constant in its precision. */
static number local(number a)
{
  if (!node_of(a)) {
    return number((double)(real)a.d);
  }
  while (graph_of(a) != R.now) {
    const int from = graph_of(a);
    if (!R.all[(std::size_t)from].open) {
      a = result(a);
      continue;
    }
    int inner = R.now;
    while (R.all[(std::size_t)inner].parent != from) {
      inner = R.all[(std::size_t)inner].parent;
    }
    a = capture(a, inner);
  }
  return a;
}

/* What is carried is an argument even where it is a number or another argument, too: all turns are one function. */
void carry_numbers(number *at, std::size_t n)
{
  if (!R.on || !R.kernels) {
    return;
  }
  const std::vector<char> &same = still[here().name];
  const int kernel = R.now;
  for (std::size_t i = 0; i < n; i++) {
    const std::size_t slot = R.all[(std::size_t)kernel].slots.size();
    R.now = R.all[(std::size_t)kernel].parent;
    const number before = local(at[i]);
    R.now = kernel;
    if (slot < same.size() && same[slot]) {
      here().slots.push_back({at + i, before, before, before, before});
      continue;
    }
    here().arguments.push_back(before);
    at[i] = push(kernel, {'i', here().n_input++, 0, 0, value(before)});
    here().slots.push_back({at + i, before, at[i], at[i], before});
  }
}

/* One sum of all that a node, and what it is made of, is. */
static std::uint64_t mixed(std::uint64_t sum, std::uint64_t with)
{
  sum = (sum ^ with) * 0x9E3779B97F4A7C15ull;
  return sum ^ sum >> 29;
}

static std::uint64_t kind_of(const graph &g)
{
  auto own = [](number a) { return node_of(a) ? (std::uint64_t)node_of(a) | number_tag : bits(a); };
  std::uint64_t sum = 1;
  for (const node &n : g.nodes) {
    sum = mixed(sum, (std::uint64_t)n.op);
    sum = mixed(sum, n.op == 'k' ? R.all[(std::size_t)n.a.d].kind : own(n.a));
    sum = mixed(mixed(sum, own(n.b)), own(n.c));
    if (n.op == 'k') {
      for (number a : R.all[(std::size_t)n.a.d].arguments) {
        sum = mixed(sum, own(a));
      }
    }
  }
  for (const guard &c : g.guards) {
    sum = mixed(mixed(mixed(sum, (std::uint64_t)c.relation + c.outcome), own(c.a)), own(c.b));
  }
  return sum;
}

/* Notes in `still` which slots of kernels have one number for ever; 1: more than before. */
static int find_still()
{
  std::map<std::string, std::vector<slot>> last;
  std::map<std::string, std::vector<char>> found;
  int more = 0;
  for (const graph &g : R.all) {
    const std::vector<slot> before = last[g.name];
    std::vector<char> &same = found[g.name];
    same.resize(g.slots.size(), 1);
    for (std::size_t i = 0; i < g.slots.size(); i++) {
      const slot &s = g.slots[i];
      const bool begins = !node_of(s.before) && (before.empty() || bits(before[i].before) == bits(s.before));
      const bool goes_on = !before.empty() && bits(before[i].left) == bits(s.before);
      const bool stays = bits(s.after) == bits(s.own) || bits(s.after) == bits(s.before);
      same[i] = same[i] && stays && (begins || goes_on);
    }
    last[g.name] = g.slots;
  }
  for (const auto &f : found) {
    std::vector<char> &same = still[f.first];
    more |= same != f.second && !f.second.empty();
    same = f.second;
  }
  return more;
}

/* What a kernel that has returned leaves in its slots, even if it is what it took. */
static void return_slots(int kernel)
{
  graph &g = R.all[(std::size_t)kernel];
  for (slot &s : g.slots) {
    s.after = *s.at;
    if (node_of(s.after) && graph_of(s.after) == kernel && node_of(s.own)) {
      *s.at = push(g.parent, {'r', number_of(g.parent, g.call), node_of(s.after), 0, value(s.after)});
    }
    s.left = *s.at;
  }
}

void kernel_begin(const char *call)
{
  if (R.on && R.kernels) {
    graph g;
    g.name = std::string(call).substr(0, std::string(call).find('('));
    g.parent = R.now;
    R.now = (int)R.all.size();
    R.all.push_back(g);
  }
}

void kernel_end()
{
  if (R.on && R.kernels) {
    const int kernel = R.now, parent = here().parent;
    here().kind = kind_of(here());
    here().open = false;
    R.now = parent;
    R.all[(std::size_t)kernel].call = node_of(push(parent, {'k', kernel, 0, 0, 0.0}));
    return_slots(kernel);
  }
}

/* ---- operations */

/* In a kernel that is a turn of a loop: what hangs on nothing that it makes is done once, before the loop. */
static bool is_before_loop(std::initializer_list<number> of)
{
  bool before = R.kernels && R.now > 0 && !here().slots.empty();
  for (number a : of) {
    int home = graph_of(a);
    while (node_of(a) && !R.all[(std::size_t)home].open) {
      home = R.all[(std::size_t)home].parent;
    }
    before = before && (!node_of(a) || home != R.now);
  }
  return before;
}

/* f() in the graph around the one that is running. */
template <class function> auto before_loop(function f) -> decltype(f())
{
  const int inner = R.now;
  R.now = here().parent;
  const auto made = f();
  R.now = inner;
  return made;
}

static bool is(number a, double x)
{
  return !node_of(a) && a.d == x;
}

/* x of a node -x, else 0 */
static number negative_of(number a)
{
  return node_of(a) && node_at(a).op == 'n' ? node_at(a).a : number(0);
}

/* What leaves the bits of the result as they are, but for the sign of zero. */
number apply(char op, number a, number b)
{
  if ((!node_of(a) && !node_of(b)) || !R.on) {
    return evaluate(op, value(a), value(b), 0.0);
  }
  if (is_before_loop({a, b})) {
    return before_loop([&] { return apply(op, a, b); });
  }
  a = local(a), b = local(b);
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
  if ((!node_of(a) && !node_of(b)) || !R.on) {
    return evaluate(relation, value(a), value(b), 0.0) != 0.0 ? yes : no;
  }
  if (is_before_loop({a, b, yes, no})) {
    return before_loop([&] { return select(relation, a, b, yes, no); });
  }
  yes = local(yes), no = local(no);
  return bits(yes) == bits(no) ? yes : make('?', make(relation, local(a), local(b), 0.0), yes, no);
}

bool ask(char relation, number a, number b)
{
  bool outcome = evaluate(relation, value(a), value(b), 0.0) != 0.0;
  if ((!node_of(a) && !node_of(b)) || !R.on) {
    return outcome;
  }
  if (is_before_loop({a, b})) {
    return before_loop([&] { return ask(relation, a, b); });
  }
  a = local(a), b = local(b);
  graph &g = here();
  const content key(relation, bits(a), bits(b), 0);
  const auto found = g.asked.find(key);
  if (found != g.asked.end()) {
    return g.guards[(std::size_t)found->second].outcome;
  }
  outcome = R.n_asked == R.turned ? !outcome : outcome;
  g.asked[key] = (int)g.guards.size();
  g.guards.push_back({relation, a, b, outcome, (int)g.nodes.size() - 1, R.n_asked++, 0, ""});
  return outcome;
}

/* Kernels: whether they have graphs of their own. */
static void begin(int turned, bool kernels)
{
  R = recording();
  R.all.resize(1);
  R.turned = turned;
  R.kernels = kernels;
  R.on = true;
}

/* ---- what a recording says */

/* What stands for all that each node is made of, the same in every recording, as if kernels stood where they are
   called. */
static void contents_of(std::vector<std::vector<std::uint64_t>> &all, const recording &r, int graph_at)
{
  const graph &g = r.all[(std::size_t)graph_at];
  std::vector<std::uint64_t> &own = all[(std::size_t)graph_at];
  auto of = [&](number a) { return node_of(a) ? own[(std::size_t)node_of(a)] : bits(a); };
  own.assign(g.nodes.size(), 0);
  for (std::size_t i = 1; i < own.size(); i++) {
    const node &n = g.nodes[i];
    if (n.op == 'k') {
      contents_of(all, r, (int)n.a.d);
    } else if (n.op == 'r') {
      own[i] = all[(std::size_t)g.nodes[(std::size_t)node_of(n.a)].a.d][(std::size_t)n.b.d];
    } else if (n.op == 'i' && graph_at > 0) {
      const number a = g.arguments[(std::size_t)n.a.d];
      own[i] = node_of(a) ? all[(std::size_t)g.parent][(std::size_t)node_of(a)] : bits(a);
    } else if (n.op == 'o') { /* of all arguments */
      own[i] = bits(n.a);
      for (int k = 1; k <= g.n_input; k++) {
        own[i] = mixed(own[i], own[(std::size_t)k]);
      }
    } else {
      own[i] = mixed(mixed(mixed((std::uint64_t)n.op, of(n.a)), of(n.b)), of(n.c));
    }
  }
}

/* Results, and the comparisons but for number `left_out`, as contents. */
static std::vector<std::uint64_t> gist(const recording &r, const std::vector<number> &results, int left_out)
{
  std::vector<std::vector<std::uint64_t>> all(r.all.size());
  std::vector<std::uint64_t> list;
  auto add = [&](int g, number a) {
    list.push_back(node_of(a) ? all[(std::size_t)g][(std::size_t)node_of(a)] : bits(a));
  };
  contents_of(all, r, 0);
  for (number a : results) {
    add(0, a);
  }
  std::map<int, std::pair<int, const guard *>> guards; /* in their order */
  for (std::size_t g = 0; g < r.all.size(); g++) {
    for (const guard &c : r.all[g].guards) {
      guards[c.order] = {(int)g, &c};
    }
  }
  for (const auto &c : guards) {
    if (c.first != left_out) {
      list.push_back((std::uint64_t)c.second.second->relation);
      add(c.second.first, c.second.second->a), add(c.second.first, c.second.second->b);
    }
  }
  return list;
}

static void rows_values(std::vector<double> &out, const std::vector<int> &kind, const std::vector<double> &in);

/* The values of all nodes of a graph at other inputs; returns the status of the first guard that does not hold, 0: all
   do. */
static int values_at(std::vector<std::vector<double>> &all, int graph_at, const std::vector<double> &inputs)
{
  const graph &g = R.all[(std::size_t)graph_at];
  std::vector<double> &v = all[(std::size_t)graph_at];
  auto at = [&](number a) { return node_of(a) ? v[(std::size_t)node_of(a)] : a.d; };
  std::size_t next = 0;
  v.assign(g.nodes.size(), 0.0);
  if (!g.apart.empty()) {
    rows_values(v, g.apart, inputs);
    v.insert(v.begin(), 1 + inputs.size(), 0.0);
    return 0;
  }
  for (std::size_t i = 1; i <= g.nodes.size(); i++) {
    for (; next < g.guards.size() && g.guards[next].after < (int)i; next++) {
      const guard &c = g.guards[next];
      if (c.status != 0 && (evaluate(c.relation, at(c.a), at(c.b), 0.0) != 0.0) != c.outcome) {
        return c.status;
      }
    }
    if (i == g.nodes.size()) {
      break;
    }
    const node &n = g.nodes[i];
    if (n.op == 'k') {
      std::vector<double> own;
      for (number a : R.all[(std::size_t)n.a.d].arguments) {
        own.push_back(at(a));
      }
      const int status = values_at(all, (int)n.a.d, own);
      if (status != 0) {
        return status;
      }
    } else if (n.op == 'r') {
      v[i] = all[(std::size_t)g.nodes[(std::size_t)node_of(n.a)].a.d][(std::size_t)n.b.d];
    } else {
      v[i] = n.op == 'i' ? (double)(real)inputs[(std::size_t)n.a.d] : evaluate(n.op, at(n.a), at(n.b), at(n.c));
    }
  }
  return 0;
}

/* Does a kernel, or one in it, check anything? Then it is called even if no result of it is used. */
static bool checks_anything(const graph &g)
{
  bool any = false;
  for (const guard &c : g.guards) {
    any = any || c.status != 0;
  }
  for (const node &n : g.nodes) {
    any = any || (n.op == 'k' && checks_anything(R.all[(std::size_t)n.a.d]));
  }
  return any;
}

/* Which arguments of kernels are read, by their kind. */
typedef std::map<std::uint64_t, std::vector<char>> read_arguments;

/* Marks what is needed for the results and, with checks, for the guards. read: NULL, all arguments of a kernel are. */
static std::vector<char> needed(const graph &g, const std::vector<number> &results, bool checks,
                                const read_arguments *read = nullptr)
{
  std::vector<char> live(g.nodes.size(), 0);
  auto mark = [&](number a) { live[(std::size_t)node_of(a)] = 1; };
  for (number r : results) {
    mark(r);
  }
  for (const guard &c : g.guards) {
    if (c.status != 0 && checks) {
      mark(c.a), mark(c.b);
    }
  }
  for (std::size_t i = g.nodes.size() - 1; i > 0; i--) {
    const node &n = g.nodes[i];
    if (n.op == 'k' && (live[i] || checks_anything(R.all[(std::size_t)n.a.d]))) {
      const graph &inner = R.all[(std::size_t)n.a.d];
      const auto known = read ? read->find(inner.kind) : read_arguments::const_iterator();
      live[i] = 1;
      for (std::size_t a = 0; a < inner.arguments.size(); a++) {
        if (!read || (known != read->end() && known->second[a])) {
          mark(inner.arguments[a]);
        }
      }
    } else if (live[i] && n.op != 'i' && n.op != 'k') {
      mark(n.a), mark(n.b), mark(n.c);
    }
  }
  return live;
}

} // namespace trace
#endif
