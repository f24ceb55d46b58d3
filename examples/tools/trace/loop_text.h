/* loop_text.h - loops of a graph as loops in C: what differs from iteration to iteration are tables and arrays. */
#ifndef TRACE_LOOP_TEXT_H
#define TRACE_LOOP_TEXT_H
#include "text.h"
#include <algorithm>

namespace trace
{

/* An array and an index in it, of texts like name[3]; index -1: not one. */
static std::pair<std::string, int> element_of(const std::string &text)
{
  const std::size_t open = text.rfind('[');
  if (open == std::string::npos || text.back() != ']' ||
      text.find_first_not_of("0123456789", open + 1) != text.size() - 1) {
    return {"", -1};
  }
  return {text.substr(0, open), std::atoi(text.c_str() + open + 1)};
}

/* How the indices of a loop go through an array: start + by j + by lane i; step 0: not one array. */
struct walk {
  std::string array;
  int start, step, lane_step;

  std::string text() const
  {
    auto part = [](int by, const char *index) {
      const std::string size = std::to_string(by < 0 ? -by : by);
      return by == 0 ? "" : (by < 0 ? " - " : " + ") + (size == "1" ? "" : size + " * ") + index;
    };
    std::string at = (start ? std::to_string(start) : "") + part(step, "j") + part(lane_step, "i");
    at = at.compare(0, 3, " + ") == 0 ? at.substr(3) : at;
    return array + "[" + at + "]";
  }
};

/* The list, lane after lane, as elements of one array. */
static walk walk_of(const std::vector<std::string> &list, int lanes)
{
  const std::size_t length = list.size() / (std::size_t)lanes;
  const auto first = element_of(list[0]);
  walk w = {first.first, first.second, 0, 0};
  w.step = element_of(list[1]).second - w.start;
  w.lane_step = lanes > 1 ? element_of(list[length]).second - w.start : 0;
  for (std::size_t k = 0; k < list.size(); k++) {
    const auto at = element_of(list[k]);
    if (at.second < 0 || at.first != w.array ||
        at.second != w.start + (int)(k % length) * w.step + (int)(k / length) * w.lane_step) {
      return {"", 0, 0, 0};
    }
  }
  return w;
}

/* The list as part of a longer one. */
static walk walk_in(const std::vector<std::string> &whole, const std::vector<std::string> &list, int lanes)
{
  const int length = (int)list.size() / lanes, size = (int)whole.size();
  for (int start = 0; start < size; start++) {
    for (int step = 1; whole[(std::size_t)start] == list[0] && start + step * (length - 1) < size; step++) {
      for (int lane_step = 0; lane_step <= (lanes > 1 ? 1 : 0); lane_step++) {
        int k = 0;
        while (k < lanes * length) {
          const int at = start + k % length * step + k / length * lane_step;
          if (at >= size || whole[(std::size_t)at] != list[(std::size_t)k]) {
            break;
          }
          k++;
        }
        if (k == lanes * length) {
          return {"", start, step, lane_step};
        }
      }
    }
  }
  return {"", 0, 0, 0};
}

static std::vector<std::string> list_of(const writer &w, const graph &g, const feed &s, bool down)
{
  std::vector<std::string> list;
  for (int j = 0; j < g.trips; j++) {
    list.push_back(w.of(g.arguments[(std::size_t)(s.first + (down ? g.trips - 1 - j : j))]));
  }
  return list;
}

/* Does a loop go down most of its arrays? */
static bool goes_down(const writer &w, const graph &g, const std::vector<char> &live)
{
  int up = 0;
  for (std::size_t k = 1; k < live.size() && g.lanes == 1; k++) {
    if (live[k] && g.nodes[k].op == 'i' && g.feeds[(std::size_t)g.nodes[k].a.d].is == feed::LISTED) {
      const int step = walk_of(list_of(w, g, g.feeds[(std::size_t)g.nodes[k].a.d], false), 1).step;
      up += step > 0 ? 1 : step < 0 ? -1 : 0;
    }
  }
  return up < 0;
}

/* An element of a table, with lanes as a number of each. */
static std::string of_table(const writer &w, const std::string &element)
{
  return w.wide ? w.name + "_wide_all(" + element + ")" : element;
}

/* What an input is at index j, which is that of the iteration, or that from the last one. */
static std::string list_text(writer &w, const graph &g, const feed &s, bool down)
{
  const std::vector<std::string> list = list_of(w, g, s, down);
  std::vector<std::string> in_turn, numbers; /* lanes beside each other, for vectors; with the lanes of a step, too */
  const std::string by_lane = g.lanes > 1 ? "[" + std::to_string(g.lanes) + " * j + i]" : "[j]";
  for (int j = 0; j < g.trips / g.lanes; j++) {
    for (int i = 0; i < g.lanes; i++) {
      const int k = i * (g.trips / g.lanes) + j;
      in_turn.push_back(list[(std::size_t)k]);
      numbers.push_back(w.alone(g.arguments[(std::size_t)(s.first + (down ? g.trips - 1 - k : k))]));
    }
  }
  bool constant = true;
  for (int j = 0; j < g.trips; j++) {
    constant = constant && !node_of(g.arguments[(std::size_t)(s.first + j)]);
  }
  if (constant) {
    for (const auto &span : w.constant_spans) {
      const walk at = walk_in(span, list, g.lanes);
      if (at.step != 0 || at.lane_step != 0) {
        return of_table(w, walk{w.table(span), at.start, at.step, at.lane_step}.text());
      }
    }
    return of_table(w, w.table(in_turn) + by_lane);
  }
  const walk at = walk_of(list, g.lanes);
  if (at.step != 0 || at.lane_step != 0) {
    return at.text();
  }
  std::string all;
  for (const std::string &x : numbers) {
    all += (all.empty() ? "" : ", ") + x;
  }
  const std::string own = "g" + std::to_string(w.n_loop++);
  w.line("const " + w.real + " " + own + "[" + std::to_string(g.trips) + "] = {" + all + "};");
  return own + by_lane;
}

/* ---- spans: numbers that the library has in a row stand in a row here, too (FB_SPAN) */

/* Does a span stand in a row in another one? */
static bool is_placed(const writer &w, const std::vector<number> &span)
{
  std::pair<std::string, int> first;
  for (std::size_t k = 0; k < span.size(); k++) {
    const auto at = w.places.find(node_of(span[k]));
    if (at == w.places.end()) {
      return false;
    }
    first = k == 0 ? at->second[0] : first;
    if (at->second[0].first != first.first || at->second[0].second != first.second + (int)k) {
      return false;
    }
  }
  return true;
}

/* Where the parts of a span are: constants as a table; of the rest those that loops want, in an array. */
static void place_spans(writer &w)
{
  std::set<int> wanted; /* nodes that differ by iteration */
  for (std::size_t i = 1; i < w.live.size(); i++) {
    if (w.live[i] && w.of_graph->nodes[i].op == 'l') {
      const graph &g = R.all[(std::size_t)w.of_graph->nodes[i].a.d];
      for (const feed &s : g.feeds) {
        for (int k = 0; s.is == feed::LISTED && k < g.trips; k++) {
          wanted.insert(node_of(g.arguments[(std::size_t)(s.first + k)]));
        }
      }
    }
  }
  std::vector<std::vector<number>> spans = w.of_graph->spans;
  auto longer = [](const std::vector<number> &a, const std::vector<number> &b) { return a.size() > b.size(); };
  std::stable_sort(spans.begin(), spans.end(), longer);
  for (const std::vector<number> &span : spans) {
    std::vector<std::string> constants;
    std::set<std::pair<int, int>> rows; /* of loops */
    int used = 0, alive = 0, single = 0;
    for (number a : span) {
      const node &n = w.of_graph->nodes[(std::size_t)node_of(a)];
      const bool live = node_of(a) && w.live[(std::size_t)node_of(a)];
      used += live && wanted.count(node_of(a));
      alive += live;
      constants.push_back(node_of(a) ? "" : w.constant(a.d));
      if (live && n.op == 'r' && w.of_graph->nodes[(std::size_t)node_of(n.a)].op == 'l') {
        rows.insert({node_of(n.a), (int)n.b.d});
      } else {
        single += live;
      }
    }
    if (alive == 0 && std::find(constants.begin(), constants.end(), "") == constants.end()) {
      w.constant_spans.insert(constants);
    }
    if (alive == 0 || 2 * used < alive || (rows.size() < 2 && single == 0) || is_placed(w, span)) {
      continue;
    }
    const std::string name = "s" + std::to_string(w.n_loop++);
    w.line(w.real + " " + name + "[" + std::to_string(span.size()) + "];");
    w.line("(void)" + name + ";");
    for (std::size_t k = 0; k < span.size(); k++) {
      if (!node_of(span[k])) {
        w.line(name + "[" + std::to_string(k) + "] = " + w.alone(span[k]) + ";");
      } else if (w.live[(std::size_t)node_of(span[k])]) {
        if (w.zero[(std::size_t)node_of(span[k])]) { /* where it is not computed */
          w.line(name + "[" + std::to_string(k) + "] = " + w.alone(0.0) + ";");
        }
        w.places[node_of(span[k])].push_back({name, (int)k});
        w.uses[(std::size_t)node_of(span[k])]++;
      }
    }
  }
}

/* The part of a span where all of these results of a loop stand, by their indices; "": there is none. Among the results of
   a kernel there is room for those that nothing asks for. */
static std::string row_place(const writer &w, const graph &g, int node, const std::vector<int> &iterations, int &start)
{
  const bool sums = (int)iterations.size() < g.trips;
  std::vector<std::string> list;
  bool all = true, in_r = !sums && g.lanes == 1;
  for (int k : iterations) {
    const auto r = g.results.find(place_of(g, k, node));
    const auto at = r == g.results.end() ? w.places.end() : w.places.find(r->second);
    if (at == w.places.end()) {
      all = false;
      continue;
    }
    const int own = at->second[0].second - k;
    list.push_back(writer::element(at->second[0]));
    in_r = in_r && at->second[0].first == "r" && (start < 0 || own == start);
    start = own;
  }
  if (!all) {
    start = in_r && 2 * (int)list.size() > g.trips && iterations[0] == 0 ? start : -1;
    return start < 0 ? "" : walk{"r", start, 1, 0}.text();
  }
  start = -1;
  const walk at = walk_of(list, sums ? 1 : g.lanes);
  return at.step <= 0 ? "" : sums ? walk{at.array, at.start, 0, at.step}.text() : at.text();
}

/* A loop as it is written. */
struct loop_writer {
  writer &w;
  const graph &g;
  const std::vector<char> live;
  const bool down;
  const int length; /* of a lane */
  const std::string name;
  std::vector<std::string> inputs, starts; /* texts; of what is carried where it starts */
  std::vector<std::size_t> carried_slots;
  std::map<int, std::string> carried; /* by the node that it becomes */
  std::map<int, bool> sums;           /* of the nodes that are results: is that of the last iteration enough? */
  std::map<int, std::string> row;     /* where they stand */
  std::map<int, int> row_start;       /* of rows among the results of a kernel that have room for others */

  loop_writer(writer &to, int i)
      : w(to), g(R.all[(std::size_t)to.of_graph->nodes[(std::size_t)i].a.d]), live(needed_in(g, to.live)),
        down(goes_down(to, g, live)), length(g.trips / g.lanes), name(std::to_string(to.n_loop++)),
        inputs(g.feeds.size()), starts(g.feeds.size())
  {
  }

  void take_inputs()
  {
    for (std::size_t k = 1; k < g.nodes.size(); k++) {
      const std::size_t s = (std::size_t)g.nodes[k].a.d;
      if (!live[k] || g.nodes[k].op != 'i') {
        continue;
      }
      const feed &own = g.feeds[s];
      const number first = g.arguments[(std::size_t)own.first];
      if (own.is == feed::LISTED) {
        inputs[s] = list_text(w, g, own, down);
      } else if (own.is == feed::STAYS) {
        inputs[s] = w.alone(first);
      } else {
        inputs[s] = "c" + name + "_" + std::to_string(carried_slots.size());
        starts[s] = w.alone(first);
        for (int lane = 1; lane < g.lanes && bits(g.arguments[(std::size_t)(own.first + lane)]) != bits(first);
             lane++) {
          const std::string both = "g" + std::to_string(w.n_loop++);
          w.line("const " + w.real + " " + both + "[2] = {" + w.alone(first) + ", " +
                 w.alone(g.arguments[(std::size_t)(own.first + lane)]) + "};");
          starts[s] = both + "[i]";
        }
        carried[node_of(own.next)] = inputs[s];
        carried_slots.push_back(s);
      }
    }
  }

  /* Iterations whose result of a node is kept, in the order of the indices. */
  std::vector<int> kept(int node)
  {
    std::vector<int> list;
    for (int k = 0; k < g.trips; k++) {
      if (!sums[node]) {
        list.push_back(down ? g.trips - 1 - k : k);
      } else if (k % length == length - 1) {
        list.push_back(k);
      }
    }
    return list;
  }

  void find_rows()
  {
    int n_row = 0;
    for (const auto &r : g.results) {
      const int node = r.first % (int)g.nodes.size(), trip = r.first / (int)g.nodes.size();
      if (w.live[(std::size_t)r.second]) {
        const bool last = trip % length == length - 1 && carried.count(node);
        sums[node] = last && (!sums.count(node) || sums[node]);
      }
    }
    for (const auto &r : sums) {
      if (r.second && g.lanes == 1) {
        continue; /* the variable itself */
      }
      int start = -1;
      const std::string place = row_place(w, g, r.first, kept(r.first), start);
      if (start >= 0) {
        row_start[r.first] = start;
      }
      const std::string index = r.second ? "i" : g.lanes > 1 ? std::to_string(length) + " * i + j" : "j";
      row[r.first] = place.empty() ? "l" + name + "[" + std::to_string(n_row++) + "][" + index + "]" : place;
    }
    if (n_row > 0) {
      w.line(w.real + " l" + name + "[" + std::to_string(n_row) + "][" + std::to_string(g.trips) + "];");
    }
  }

  std::vector<int> count_uses() const
  {
    std::vector<int> uses(g.nodes.size(), 0);
    auto use = [&](number a, int by) { uses[(std::size_t)node_of(a)] += by; };
    for (std::size_t k = 1; k < uses.size(); k++) {
      const node &n = g.nodes[k];
      if (live[k] && n.op != 'i') {
        use(n.a, 1), use(n.b, 1), use(n.c, 1);
      }
    }
    for (const auto &r : row) {
      uses[(std::size_t)r.first]++;
    }
    for (std::size_t s : carried_slots) {
      use(g.feeds[s].next, 2);
    }
    for (const guard &c : g.guards) {
      if (c.status != 0) {
        use(c.a, 1), use(c.b, 1);
      }
    }
    return uses;
  }

  void write_iteration()
  {
    std::size_t next = 0;
    for (std::size_t k = 1; k <= live.size(); k++) {
      for (; next < g.guards.size() && g.guards[next].after < (int)k; next++) {
        if (g.guards[next].status != 0) {
          w.check(g.guards[next]);
        }
      }
      if (k < live.size() && live[k]) {
        w.statement((int)k);
        if (row.count((int)k) && !sums[(int)k]) {
          w.line(row[(int)k] + " = " + w.text[k] + ";");
        }
      }
    }
    for (std::size_t s : carried_slots) {
      w.line(w.names[s] + " = " + w.alone(g.feeds[s].next) + ";");
    }
  }

  void write_lane()
  {
    const std::string last = std::to_string(length - 1), end = std::to_string(length);
    for (std::size_t s : carried_slots) {
      w.line(w.real + " " + inputs[s] + " = " + starts[s] + ";");
    }
    std::vector<int> uses = count_uses();
    std::vector<std::string> text(g.nodes.size());
    std::vector<char> outlasts(g.nodes.size(), 0);
    const graph *of = &g;
    auto swap_all = [&] {
      std::swap(w.uses, uses), std::swap(w.text, text), std::swap(w.names, inputs), std::swap(w.of_graph, of);
      std::swap(w.outlasts, outlasts);
    };
    if (!carried_slots.empty()) { /* no compiler computes such iterations together by itself */
      w.line(w.name + "_UNROLL");
    }
    w.line(down ? "for (int j = " + last + "; j >= 0; j--) {" : "for (int j = 0; j < " + end + "; j++) {");
    swap_all();
    w.indent += 2;
    write_iteration();
    w.indent -= 2;
    swap_all();
    w.line("}");
    for (const auto &r : row) {
      if (sums[r.first]) {
        w.line(r.second + " = " + carried[r.first] + ";");
      }
    }
  }

  /* Texts of the results in the graph around. */
  void give_results()
  {
    for (const auto &r : g.results) {
      const int node = r.first % (int)g.nodes.size(), trip = r.first / (int)g.nodes.size();
      if (!w.live[(std::size_t)r.second]) {
        continue;
      }
      std::string &own = w.text[(std::size_t)r.second];
      const std::string outside = w.outlasts[(std::size_t)r.second] ? own : "";
      const auto in_span = w.places.find(r.second);
      const bool placed = row.count(node) && row[node][0] != 'l' && in_span != w.places.end();
      if (placed) {
        own = writer::element(in_span->second[0]);
      } else if (row_start.count(node)) {
        own = writer::element({"r", row_start[node] + trip});
      } else if (row.count(node)) {
        const std::string &at = row[node];
        const int index = sums[node] ? trip / length : down ? length - 1 - trip : trip;
        own = at.substr(0, at.rfind('[') + 1) + std::to_string(index) + "]";
      } else {
        own = carried[node];
      }
      if (!outside.empty()) {
        w.line(outside + " = " + own + ";");
        own = outside;
      }
      w.put(r.second, placed);
    }
  }
};

static void write_loop(writer &w, int i)
{
  loop_writer loop(w, i);
  loop.take_inputs();
  loop.find_rows();
  if (loop.g.lanes > 1) {
    w.line("for (int i = 0; i < " + std::to_string(loop.g.lanes) + "; i++) {");
    w.indent += 2;
  }
  loop.write_lane();
  if (loop.g.lanes > 1) {
    w.indent -= 2;
    w.line("}");
  }
  loop.give_results();
}

} // namespace trace
#endif
