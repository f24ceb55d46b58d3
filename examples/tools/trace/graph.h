/* graph.h - the operations that the library has made of inputs, and the comparisons on which it has branched. A part of
   the library that is marked as a kernel (FB_KERNEL) has a graph of its own at each call: what it uses of the graphs
   around it are its arguments, what they use of it afterwards its results. So has a loop that is marked (FB_LOOP): its
   iterations stand one behind the other until it ends, then one of them stands for all (roll.h). */
#ifndef TRACE_GRAPH_H
#define TRACE_GRAPH_H
#include "number.h"
#include <algorithm>
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

/* What stands for an input of a loop's body: a number that stays, one of each iteration, or what the iteration before it
   has made, at first (of each lane) that number. */
struct feed {
  enum kind { STAYS, LISTED, CARRIED } is;
  int first;   /* of its arguments */
  number next; /* CARRIED: in the body */
};

/* What a recorded node of a loop is: a number of its body in an iteration; where no iteration is like the others, of the
   parent. */
struct standing {
  number what;
  int iteration;
  double value;
};

struct graph {
  std::vector<node> nodes{1}; /* [0] is none */
  std::vector<guard> guards;
  std::vector<std::vector<number>> lists; /* operands of nodes that have many */
  std::unordered_map<content, int, content_hash> known, asked;
  int n_input = 0;

  /* of a kernel */
  std::string name;
  std::uint64_t kind = 0;        /* that of kernels with the same operations */
  int parent = -1, call = 0;     /* the graph that calls it, the node there once it has returned */
  bool open = true;              /* still running */
  std::vector<number> arguments; /* of the parent */
  std::unordered_map<std::uint64_t, int> captured;
  std::map<int, int> results; /* its node, of a loop with the iteration (place_of): that of the parent */
  std::vector<int> apart;     /* kinds of rows: its results come of the library's own text (apart.h) */
  std::vector<slot> slots;
  std::size_t own = 0; /* nodes when it ended; what follows are results of what it calls (settle) */

  std::vector<std::vector<number>> spans; /* numbers that stand in a row */

  /* of a loop */
  bool loops = false, pairs = false; /* it computes pairs of numbers */
  std::vector<int> starts;           /* of iterations, while they are recorded; none: it has ended */
  int trips = 0;                     /* iterations of nodes; 0: none is like the others, they stand in the parent */
  int lanes = 1;                     /* parts of them, one after the other, that begin anew */
  std::vector<feed> feeds;           /* its inputs */
  std::vector<standing> stands;      /* for each node that was recorded */
};

struct recording {
  std::vector<graph> all; /* [0] is the outermost */
  int now = 0;            /* the graph that is running */
  bool on = false, kernels = false, loops = false;
  bool plain = false;  /* nothing is recorded, but comparisons are those of a recording */
  int turned = -1;     /* the guard whose outcome is turned round */
  int n_asked = 0;     /* comparisons */
  int conversions = 0; /* to int, of numbers that depend on inputs */
  int n_shortcut = 0;
  bool guessing = false, certain = true; /* a shortcut is asked for; by no number that depends on inputs */
};

static recording R;

bool is_recording()
{
  return R.on || R.plain;
}

/* Which shortcuts the last recording has taken, in order: one without a graph cannot know them. */
static std::vector<char> shortcuts;

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
  if (!node_of(a)) {
    return (double)(real)a.d;
  }
  const graph &g = R.all[(std::size_t)graph_of(a)];
  return g.loops && !g.open ? g.stands[(std::size_t)node_of(a)].value : node_at(a).value;
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

/* Are iterations of a loop recorded? Each keeps all of its operations, so that they are alike. */
static bool loops()
{
  return !here().starts.empty();
}

static number make(char op, number a, number b, number c)
{
  if (loops()) {
    return push(R.now, {op, a, b, c, evaluate(op, value(a), value(b), value(c))});
  }
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

/* A number of the model: no argument, known everywhere. */
static number of_model(int index, double x)
{
  const content key('m', bits(index), 0, 0);
  const auto found = here().known.find(key);
  if (found != here().known.end()) {
    return number_of(R.now, found->second);
  }
  const number made = push(R.now, {'m', index, 0, 0, x});
  here().known[key] = node_of(made);
  return made;
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

/* What input `index` of a loop's body is in an iteration: a number of the parent, or of the body in the iteration before. */
static number argument(const graph &g, int index, int iteration, bool *before)
{
  const feed &s = g.feeds[(std::size_t)index];
  const int length = g.trips / g.lanes;
  const int own = s.is == feed::LISTED ? iteration : s.is == feed::CARRIED ? iteration / length : 0;
  *before = s.is == feed::CARRIED && iteration % length > 0;
  return *before ? s.next : g.arguments[(std::size_t)(s.first + own)];
}

/* Arguments of an input of a loop. */
static int arguments_of(const graph &g, const feed &s)
{
  return s.is == feed::LISTED ? g.trips : s.is == feed::CARRIED ? g.lanes : 1;
}

/* A node of a loop's body in an iteration as one number; of a kernel its node. */
static int place_of(const graph &g, int iteration, int node)
{
  return iteration * (int)g.nodes.size() + node;
}

/* Results of calls in kernels that have ended by then, by the kind of the kernel: they stand in one order in all kernels of
   a kind, whoever asks first. */
struct late_result {
  int call, node, iteration;
};

static std::map<std::uint64_t, std::vector<late_result>> late;

static void push_result(int parent, const late_result &r)
{
  const int called = (int)R.all[(std::size_t)parent].nodes[(std::size_t)r.call].a.d;
  const number made = push(parent, {'r', number_of(parent, r.call), r.node, r.iteration, 0.0});
  graph &g = R.all[(std::size_t)called];
  g.results[place_of(g, r.iteration, r.node)] = node_of(made);
}

/* The first of the late results of a kernel, as many as n. */
static void settle(int kernel, std::size_t n)
{
  const std::vector<late_result> list = late[R.all[(std::size_t)kernel].kind];
  for (std::size_t k; (k = R.all[(std::size_t)kernel].nodes.size() - R.all[(std::size_t)kernel].own) < n;) {
    const int called = (int)R.all[(std::size_t)kernel].nodes[(std::size_t)list[k].call].a.d;
    const graph &g = R.all[(std::size_t)called];
    if (!g.loops && (std::size_t)list[k].node >= g.own) {
      settle(called, (std::size_t)list[k].node + 1 - g.own);
    }
    push_result(kernel, list[k]);
  }
}

/* A node of a kernel or a loop that has returned as a result of its call. */
static void add_result(int called, int node, int iteration)
{
  const graph &g = R.all[(std::size_t)called], &parent = R.all[(std::size_t)g.parent];
  const late_result r = {g.call, node, iteration};
  if (parent.open) {
    push_result(g.parent, r);
    return;
  }
  std::vector<late_result> &list = late[parent.kind];
  const auto same = [&](const late_result &x) {
    return x.call == r.call && x.node == r.node && x.iteration == r.iteration;
  };
  const std::size_t at = (std::size_t)(std::find_if(list.begin(), list.end(), same) - list.begin());
  if (at == list.size()) {
    list.push_back(r);
  }
  settle(g.parent, at + 1);
}

/* A number of a kernel or a loop that has returned, as its parent has it. */
static number result(number a)
{
  const number from = a;
  const graph &g = R.all[(std::size_t)graph_of(a)];
  int iteration = 0;
  const double was = g.loops ? g.stands[(std::size_t)node_of(a)].value : value(a);
  if (g.loops) {
    const standing stands = g.stands[(std::size_t)node_of(a)];
    a = stands.what, iteration = stands.iteration;
    bool before = g.trips > 0;
    while (before && node_of(a) && g.nodes[(std::size_t)node_of(a)].op == 'i') {
      a = argument(g, (int)g.nodes[(std::size_t)node_of(a)].a.d, iteration, &before);
      iteration -= before;
    }
    if (!before || !node_of(a)) {
      return a;
    }
  }
  const node n = g.nodes[(std::size_t)node_of(a)];
  if (n.op == 'i') {
    return g.arguments[(std::size_t)n.a.d];
  }
  const int place = place_of(g, iteration, node_of(a));
  const auto found = g.results.find(place);
  if (found == g.results.end()) {
    add_result(graph_of(from), node_of(a), iteration);
  }
  const int made = R.all[(std::size_t)graph_of(from)].results.at(place),
            parent = R.all[(std::size_t)graph_of(from)].parent;
  R.all[(std::size_t)parent].nodes[(std::size_t)made].value = was;
  return number_of(parent, made);
}

/* The same number in the graph that is running; a constant in its precision. */
static number local(number a)
{
  if (!node_of(a)) {
    return number((double)(real)a.d);
  }
  if (node_at(a).op == 'm') {
    return of_model((int)node_at(a).a.d, node_at(a).value);
  }
  while (graph_of(a) != R.now) {
    const int from = graph_of(a);
    if (!R.all[(std::size_t)from].open) {
      a = result(a);
      if (!node_of(a)) {
        return a;
      }
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

/* Of a kernel or a loop. */
static bool is_call(const node &n)
{
  return n.op == 'k' || n.op == 'l';
}

static std::uint64_t kind_of(const graph &g)
{
  auto own = [](number a) { return node_of(a) ? (std::uint64_t)node_of(a) | number_tag : bits(a); };
  std::uint64_t sum = 1;
  for (const std::vector<number> &list : g.lists) {
    for (number a : list) {
      sum = mixed(sum, own(a));
    }
  }
  for (const node &n : g.nodes) {
    sum = mixed(sum, (std::uint64_t)n.op);
    sum = mixed(sum, is_call(n) ? R.all[(std::size_t)n.a.d].kind : own(n.a));
    sum = mixed(mixed(sum, own(n.b)), own(n.c));
    if (is_call(n)) {
      for (number a : R.all[(std::size_t)n.a.d].arguments) {
        sum = mixed(sum, own(a));
      }
    }
  }
  for (const guard &c : g.guards) {
    sum = mixed(mixed(mixed(sum, (std::uint64_t)c.relation + c.outcome), own(c.a)), own(c.b));
  }
  for (const feed &c : g.feeds) {
    sum = mixed(mixed(mixed(sum, (std::uint64_t)c.is), (std::uint64_t)c.first), own(c.next));
  }
  return mixed(mixed(sum, (std::uint64_t)g.trips), (std::uint64_t)g.lanes);
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
    here().own = here().nodes.size();
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

/* What a node is made of, of its own graph: but for calls of kernels. */
static std::vector<number> operands(const graph &g, const node &n)
{
  return n.op == 'v'                 ? g.lists[(std::size_t)n.a.d]
         : n.op == 'i' || is_call(n) ? std::vector<number>()
                                     : std::vector<number>{n.a, n.b, n.c};
}

bool set_aside(const number *A, const number *B, int n)
{
  bool any = false;
  for (int i = 0; i < n * n; i++) {
    any = any || node_of(A[i]) || node_of(B[i]);
  }
  R.on = R.on && !any;
  return any;
}

number take_up(const number *A, const number *B, int n, number largest)
{
  std::vector<number> list;
  R.on = true;
  for (const number *of : {A, B}) {
    for (int i = 0; i < n * n; i++) {
      list.push_back(local(of[i]));
    }
  }
  here().lists.push_back(list);
  return push(R.now, {'v', (double)here().lists.size() - 1.0, 0, 0, value(largest)});
}

/* As the library finds it. */
static double largest_of(std::vector<double> list)
{
  const int n = (int)(std::sqrt(0.5 * (double)list.size()) + 0.5);
  std::vector<number> A(list.begin(), list.begin() + n * n), B(list.begin() + n * n, list.end()), X(A), d(A);
  return fb_eig_gen_solve(&d[0], &X[0], &A[0], &B[0], n) == FB_OK ? (double)d[(std::size_t)n - 1] : 0.0;
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

/* Sums of |x|, which tell of what is no number: zero times one is not left out. */
static bool is_size(number a)
{
  const node &n = here().nodes[(std::size_t)node_of(a)];
  return node_of(a) && (n.op == 'f' || (n.op == '+' && is_size(n.a) && is_size(n.b)));
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
  if (loops() || (!node_of(a) && !node_of(b))) {
    return node_of(a) || node_of(b) ? make(op, a, b, 0.0) : number(evaluate(op, value(a), value(b), 0.0));
  }
  if (op == '*' && ((is(a, 0.0) && !is_size(b)) || (is(b, 0.0) && !is_size(a)))) {
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
  return bits(yes) == bits(no) && !loops() ? yes : make('?', make(relation, local(a), local(b), 0.0), yes, no);
}

bool guess(bool begins)
{
  R.guessing = begins;
  if (begins) {
    R.certain = true;
    return false;
  }
  const std::size_t at = (std::size_t)R.n_shortcut++;
  if (R.on && R.turned < 0) {
    shortcuts.resize(at);
    shortcuts.push_back(R.certain);
  }
  return R.on ? R.certain : at < shortcuts.size() && shortcuts[at];
}

bool ask(char relation, number a, number b)
{
  bool outcome = evaluate(relation, value(a), value(b), 0.0) != 0.0;
  if (R.guessing) {
    R.certain = R.certain && !node_of(a) && !node_of(b);
    return outcome;
  }
  if (R.on && (node_of(a) || node_of(b)) && is_before_loop({a, b})) {
    return before_loop([&] { return ask(relation, a, b); });
  }
  const int order = R.n_asked++; /* the same with a graph and without */
  if (!R.on || (!node_of(a) && !node_of(b))) {
    return order == R.turned ? !outcome : outcome;
  }
  a = local(a), b = local(b);
  graph &g = here();
  const content key(relation, bits(a), bits(b), 0);
  const auto found = g.asked.find(key);
  if (found != g.asked.end() && !loops() && order != R.turned) {
    return g.guards[(std::size_t)found->second].outcome;
  }
  outcome = order == R.turned ? !outcome : outcome;
  g.asked[key] = (int)g.guards.size();
  g.guards.push_back({relation, a, b, outcome, (int)g.nodes.size() - 1, order, 0, ""});
  return outcome;
}

/* What of a run is recorded: nothing, one graph, kernels by themselves, loops, too. */
enum detail { PLAIN, FLAT, KERNELS, LOOPS };

static void begin(int turned, detail with)
{
  R = recording();
  R.all.resize(1);
  R.turned = turned;
  R.kernels = with >= KERNELS;
  R.loops = with >= LOOPS;
  R.on = with > PLAIN;
  R.plain = with == PLAIN;
}

/* ---- what a recording says */

/* What stands for all that each node is made of, the same in every recording, as if kernels stood where they are
   called. */
static void contents_of(std::vector<std::vector<std::uint64_t>> &all, const recording &r, int graph_at)
{
  const graph &g = r.all[(std::size_t)graph_at];
  const std::size_t size = g.nodes.size();
  std::vector<std::uint64_t> &own = all[(std::size_t)graph_at];
  auto at = [&](int in, number a) { return node_of(a) ? all[(std::size_t)in][(std::size_t)node_of(a)] : bits(a); };
  own.assign(size * (std::size_t)(g.trips > 0 ? g.trips : 1), 0);
  for (std::size_t i = 1; i < own.size(); i++) {
    const int trip = (int)(i / size), start = trip * (int)size;
    auto of = [&](number a) { return node_of(a) ? own[(std::size_t)(start + node_of(a))] : bits(a); };
    const node &n = g.nodes[i % size];
    if (is_call(n)) {
      contents_of(all, r, (int)n.a.d);
    } else if (n.op == 'r') {
      const int from = (int)g.nodes[(std::size_t)node_of(n.a)].a.d;
      own[i] = all[(std::size_t)from][(std::size_t)place_of(r.all[(std::size_t)from], (int)n.c.d, (int)n.b.d)];
    } else if (n.op == 'v') {
      own[i] = 'v';
      for (number a : operands(g, n)) {
        own[i] = mixed(own[i], of(a));
      }
    } else if (n.op == 'i' && g.trips > 0) {
      bool before;
      const number a = argument(g, (int)n.a.d, trip, &before);
      own[i] = !before ? at(g.parent, a) : node_of(a) ? own[(std::size_t)(start - (int)size + node_of(a))] : bits(a);
    } else if (n.op == 'i' && graph_at > 0) {
      own[i] = at(g.parent, g.arguments[(std::size_t)n.a.d]);
    } else if (n.op == 'o') { /* of all arguments */
      own[i] = bits(n.a);
      for (int k = 1; k <= g.n_input; k++) {
        own[i] = mixed(own[i], own[(std::size_t)k]);
      }
    } else if (i % size > 0) {
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

/* The numbers of the model, at which graphs are evaluated. */
static std::vector<double> model_now;

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
    if (is_call(n)) {
      const int called = (int)n.a.d;
      const graph &inner = R.all[(std::size_t)called];
      std::vector<double> kept;
      for (int trip = 0; trip < (inner.trips > 0 ? inner.trips : 1); trip++) {
        std::vector<double> own;
        for (std::size_t k = 0; k < (inner.loops ? inner.feeds.size() : inner.arguments.size()); k++) {
          bool before = false;
          const number a = inner.loops ? argument(inner, (int)k, trip, &before) : inner.arguments[k];
          own.push_back(!before ? at(a) : node_of(a) ? all[(std::size_t)called][(std::size_t)node_of(a)] : a.d);
        }
        const int status = values_at(all, called, own);
        if (status != 0) {
          return status;
        }
        kept.insert(kept.end(), all[(std::size_t)called].begin(), all[(std::size_t)called].end());
      }
      all[(std::size_t)called] = kept;
    } else if (n.op == 'r') {
      const int from = (int)g.nodes[(std::size_t)node_of(n.a)].a.d;
      v[i] = all[(std::size_t)from][(std::size_t)place_of(R.all[(std::size_t)from], (int)n.c.d, (int)n.b.d)];
    } else if (n.op == 'm') {
      v[i] = model_now[(std::size_t)n.a.d];
    } else if (n.op == 'v') {
      std::vector<double> list;
      for (number a : operands(g, n)) {
        list.push_back(at(a));
      }
      v[i] = largest_of(list);
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
    any = any || (is_call(n) && checks_anything(R.all[(std::size_t)n.a.d]));
  }
  return any;
}

/* Which arguments of kernels are read, by their kind. */
typedef std::map<std::uint64_t, std::vector<char>> read_arguments;

/* Of a loop what of its body is needed for results that are live in its parent and for its guards. */
static std::vector<char> needed_in(const graph &g, const std::vector<char> &live_in_parent)
{
  std::vector<char> live(g.nodes.size(), 0);
  auto mark = [&](number a) { live[(std::size_t)node_of(a)] = 1; };
  for (const auto &r : g.results) {
    live[(std::size_t)r.first % live.size()] |= live_in_parent[(std::size_t)r.second];
  }
  for (const guard &c : g.guards) {
    if (c.status != 0) {
      mark(c.a), mark(c.b);
    }
  }
  for (bool more = true; more;) {
    const std::vector<char> before = live;
    for (std::size_t i = live.size() - 1; i > 0; i--) {
      const node &n = g.nodes[i];
      if (live[i] && n.op == 'i' && g.feeds[(std::size_t)n.a.d].is == feed::CARRIED) {
        mark(g.feeds[(std::size_t)n.a.d].next);
      } else if (live[i] && n.op != 'i') {
        mark(n.a), mark(n.b), mark(n.c);
      }
    }
    live[0] = 0;
    more = live != before;
  }
  return live;
}

/* Arguments of a call that it needs: of a kernel those that it reads, by NULL all; of a loop by what is needed in it. */
static std::vector<number> arguments_of(const graph &g, const std::vector<char> &live_in_parent,
                                        const read_arguments *read)
{
  std::vector<number> list;
  if (!g.loops) {
    const auto known = read ? read->find(g.kind) : read_arguments::const_iterator();
    for (std::size_t a = 0; a < g.arguments.size(); a++) {
      if (!read || (known != read->end() && known->second[a])) {
        list.push_back(g.arguments[a]);
      }
    }
    return list;
  }
  const std::vector<char> live = needed_in(g, live_in_parent);
  for (std::size_t i = 1; i < live.size(); i++) {
    if (live[i] && g.nodes[i].op == 'i') {
      const feed &s = g.feeds[(std::size_t)g.nodes[i].a.d];
      for (int k = 0; k < arguments_of(g, s); k++) {
        list.push_back(g.arguments[(std::size_t)(s.first + k)]);
      }
    }
  }
  return list;
}

/* Does a graph have loops? What stands in rows for them is not factored: iterations that are alike have to stay alike. */
static bool has_loops(const graph &g)
{
  bool any = false;
  for (const node &n : g.nodes) {
    any = any || n.op == 'l';
  }
  return any;
}

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
  for (bool more = true; more;) { /* again where a loop needs what stands behind it (join.h) */
    more = false;
    for (std::size_t i = g.nodes.size() - 1; i > 0; i--) {
      const node &n = g.nodes[i];
      if (is_call(n) && (live[i] || checks_anything(R.all[(std::size_t)n.a.d]))) {
        live[i] = 1;
        for (number a : arguments_of(R.all[(std::size_t)n.a.d], live, read)) {
          more = more || (node_of(a) > (int)i && !live[(std::size_t)node_of(a)]);
          mark(a);
        }
      } else if (live[i] && !is_call(n)) {
        for (number a : operands(g, n)) {
          mark(a);
        }
      }
    }
  }
  return live;
}

} // namespace trace
#endif
