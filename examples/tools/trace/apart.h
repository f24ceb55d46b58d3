/* apart.h - the choice of independent rows of closed loops, which branches on values: the library's own text stands in what is
   written (rows_text.h, which the Makefile takes from flexbeam_impl.h), as a kernel of the graph with its numbers as
   arguments and results. */
#ifndef TRACE_APART_H
#define TRACE_APART_H
#include "graph.h"
#include <memory>
#include <regex>

namespace trace
{

static const char rows_text[] =
#include "build/tool/rows_text.h"
    ;

/* Values of the multipliers and the angles. in: lower triangle of Q, column, c. */
static void rows_values(std::vector<double> &out, const std::vector<int> &kind, const std::vector<double> &in)
{
  static std::unique_ptr<fb_system_work> w(new fb_system_work);
  const int asked = R.n_asked, turned = R.turned; /* its own comparisons are none of the recording */
  R.turned = -1;
  const int m = w->n_row = (int)kind.size();
  std::size_t k = 0;
  for (int i = 0; i < m; i++) {
    w->kind[i] = kind[(std::size_t)i];
    for (int j = 0; j <= i; j++) {
      w->Q[i * m + j] = w->Q[j * m + i] = in[k++];
    }
  }
  for (int i = 0; i < m; i++) {
    w->column[i] = in[k + (std::size_t)i];
    w->c[i] = in[k + (std::size_t)(m + i)];
  }
  fbi_rows_apart(w.get());
  R.n_asked = asked;
  R.turned = turned;
  out.clear();
  for (const number *list : {w->mu, w->angle}) {
    for (int i = 0; i < m; i++) {
      out.push_back(list[i].d);
    }
  }
}

void apart(void *of)
{
  fb_system_work *const w = (fb_system_work *)of;
  const int m = w->n_row, index = (int)R.all.size();
  std::vector<double> values, results;
  std::vector<int> row; /* the others move nothing, whatever the state: they are left out */
  graph g;
  if (!is_recording()) {
    fbi_rows_apart(w);
    return;
  }
  for (int r = 0; r < m; r++) {
    bool moves = !is(w->c[r], 0.0);
    for (int i = 0; i < m; i++) {
      moves = moves || !is(w->Q[r * m + i], 0.0);
    }
    w->mu[r] = 0.0;
    w->angle[r] = -1.0;
    if (moves) {
      row.push_back(r);
      g.apart.push_back(w->kind[r]);
    }
  }
  w->rank = -1; /* depends on values */
  if (row.empty()) {
    return;
  }
  for (int i : row) {
    for (int j : row) {
      if (j <= i) {
        g.arguments.push_back(w->Q[i * m + j]);
      }
    }
  }
  for (const number *list : {w->column, w->c}) {
    for (int i : row) {
      g.arguments.push_back(list[i]);
    }
  }
  for (number &a : g.arguments) {
    a = local(a);
    values.push_back(value(a));
    g.nodes.push_back({'i', g.n_input++, 0, 0, values.back()});
  }
  g.name = "rows";
  g.parent = R.now;
  g.kind = mixed(number_tag, (std::uint64_t)row.size());
  for (int kind : g.apart) {
    g.kind = mixed(g.kind, (std::uint64_t)kind);
  }
  rows_values(results, g.apart, values);
  auto result_at = [&](std::size_t i) -> number & {
    return i < row.size() ? w->mu[row[i]] : w->angle[row[i - row.size()]];
  };
  for (std::size_t i = 0; i < results.size(); i++) {
    result_at(i) = results[i];
  }
  if (!R.on) {
    return;
  }
  for (std::size_t i = 0; i < results.size(); i++) {
    g.nodes.push_back({'o', (int)i, 0, 0, results[i]});
  }
  g.open = false;
  R.all.push_back(g);
  const number call = push(R.now, {'k', index, 0, 0, 0.0});
  R.all[(std::size_t)index].call = node_of(call);
  for (std::size_t i = 0; i < results.size(); i++) {
    result_at(i) = push(R.now, {'r', call, g.n_input + 1 + (int)i, 0, results[i]});
  }
}

/* The library's functions, by the names of a file, once: steps of one model and of all lanes share them. */
static std::string rows_functions(const std::string &name, const std::string &real, bool single, int rows)
{
  const std::string n = std::to_string(rows), square = std::to_string(rows * rows), huge = single ? "1e18f" : "1e150";
  std::string s = rows_text;
  for (const auto &change :
       std::initializer_list<std::pair<const char *, std::string>>{{"FB_R\\(([^)]*)\\)", single ? "$1f" : "$1"},
                                                                   {"FB_SINGLE", single ? "1" : "0"},
                                                                   {"FB_HUGE", huge},
                                                                   {"FB_SQRT", single ? "sqrtf" : "sqrt"},
                                                                   {"fb_system_work", name + "_work"},
                                                                   {"fb_real", real},
                                                                   {"fbi_rows_", name + "_rows_"}}) {
    s = std::regex_replace(s, std::regex(change.first), change.second);
  }
  return "#ifndef " + name + "_ROWS_APART\n#define " + name + "_ROWS_APART 1\ntypedef struct " + name +
         "_work {\n  int n_row, rank, kind[" + n + "], order[" + n + "];\n  " + real + " Q[" + square + "], L[" +
         square + "], mu[" + n + "], c[" + n + "], column[" + n + "], diagonal[" + n + "], angle[" + n + "];\n} " +
         name + "_work;\n\n" + s + "#endif\n\n";
}

} // namespace trace
#endif
