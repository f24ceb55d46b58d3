/* replay.h - a function of the library as a graph: what its comparisons decide, found by turning each round, and the graph
   held against the library at other states. */
#ifndef TRACE_REPLAY_H
#define TRACE_REPLAY_H
#include "roll.h"

namespace trace
{

struct entry {
  std::string name;
  number *at;
};

/* A model with its state and input, as a list of numbers each. Functions of it: 0 the rates, then one for each sensor. */
struct subject {
  std::vector<entry> state, input;
  std::vector<std::vector<number *>> model; /* its numbers that vary, each wherever it stands */
  std::vector<std::string> sensor;
  std::vector<int> quaternion;                       /* where in the state one begins */
  std::vector<std::pair<int, const fb_body *>> bent; /* where in the state q of a body begins */
  std::uint32_t seed = 1;
  bool reads = false; /* what it says of a state is part of what the library does: it does not check the rest */

  virtual ~subject()
  {
  }
  virtual fb_status eval(int function, std::vector<entry> &results) = 0;
  virtual fb_status wander(double size) = 0; /* a random state and input, further away the larger size is */

  double random() /* -1 .. 1 */
  {
    seed = 1664525u * seed + 1013904223u;
    return (double)(seed >> 8) / 8388608.0 - 1.0;
  }

  /* Of a mode: at a part of what the body may deflect. Torsion may move no node: then as a mode that does. */
  static double most_of(const fb_body &body, int mode, double part)
  {
    double reach = (double)body.reach[mode], longest = 0.0;
    for (int a = 0; a < body.n; a++) {
      longest = std::fmax(longest, (double)body.reach[a]);
    }
    reach = reach < 1e-3 * longest ? longest : reach;
    return reach > 0.0 ? part * (double)body.deflection_limit / (body.n * reach) : part;
  }

  static void add(std::vector<entry> &list, number *at, int n, const std::string &name)
  {
    for (int i = 0; i < n; i++) {
      list.push_back({name + (n > 1 ? "[" + std::to_string(i) + "]" : ""), at + i});
    }
  }

  /* A list of a member is one in what is written, too, where it has one number. */
  static void add_list(std::vector<entry> &list, number *at, int n, const std::string &name)
  {
    for (int i = 0; i < n; i++) {
      list.push_back({name + "[" + std::to_string(i) + "]", at + i});
    }
  }

  void add_quaternion(number *at, const std::string &name)
  {
    quaternion.push_back((int)state.size());
    add(state, at, 4, name);
  }

  void set(const std::vector<double> &v)
  {
    std::size_t i = 0;
    for (auto *list : {&state, &input}) {
      for (entry &e : *list) {
        *e.at = v[i++];
      }
    }
    for (const auto &list : model) {
      for (number *at : list) {
        *at = v[i];
      }
      i++;
    }
  }

  std::vector<double> values() const
  {
    std::vector<double> v;
    for (const auto *list : {&state, &input}) {
      for (const entry &e : *list) {
        v.push_back((double)*e.at);
      }
    }
    for (const auto &list : model) {
      v.push_back((double)*list[0]);
    }
    return v;
  }
};

/* ---- tracing */

/* A random state of bodies on joints around `start`. */
static fb_status wander_links(subject &s, const fb_system &system, const fb_body *body, fb_system_state &now,
                              const fb_system_state &start, double size)
{
  now = start;
  for (int k = 0; k < system.n_body; k++) {
    const fb_joint &joint = system.joint[k];
    const fb_body &own = body[system.model[k]];
    fb_link_state &link = now.link[k];
    const bool root = joint.kind == FB_JOINT_FREE, ball = joint.kind == FB_JOINT_SPHERICAL;
    for (int i = 0; i < 3; i++) {
      link.x[i] += root || i < joint.n_axis ? 0.2 * size * s.random() : 0.0;
      link.quat[i + 1] += root || ball ? 0.1 * size * s.random() : 0.0;
      link.u[i] += root && !system.tied ? size * s.random() : 0.0;
    }
    if (root || ball) {
      FBI_TRY(fb_quat_normalize(link.quat));
    }
    for (int i = 0; i < joint.n_axis; i++) {
      link.p[i] += 0.1 * size * (double)own.mass * s.random();
    }
    for (int a = 0; a < own.n_coordinate; a++) {
      const bool mode = a < own.n;
      const double most = mode ? s.most_of(own, a, 0.1 * size) : 0.1;
      link.q[a] += most * s.random();
      link.pi[a] += mode ? 0.1 * size * (double)own.mass * s.random() : 0.1 * s.random();
    }
  }
  return FB_OK;
}

/* Runs function f at the present state with the comparison `turned` turned round; the state is left as it was. */
static fb_status run(subject &s, int f, int turned, std::vector<number> &results, std::vector<std::string> *names,
                     detail with)
{
  const std::vector<double> before = s.values();
  std::vector<entry> found;
  std::size_t i = 0;
  begin(turned, with);
  for (auto *list : {&s.state, &s.input}) {
    for (entry &e : *list) {
      *e.at = with == PLAIN ? number(before[i]) : input(before[i]);
      i++;
    }
  }
  for (std::size_t k = 0; k < s.model.size(); k++) {
    for (number *at : s.model[k]) {
      *at = of_model((int)k, before[i + k]);
    }
  }
  const fb_status status = s.eval(f, found);
  results.clear();
  for (const entry &e : found) {
    results.push_back(with == PLAIN ? *e.at : local(*e.at));
    if (names) {
      names->push_back(e.name);
    }
  }
  R.on = R.plain = false;
  s.set(before);
  return status;
}

/* What each comparison decides, by turning it round: nothing, where results and all other comparisons are the same. In
   kernels of one kind it decides the same. */
static void judge_guards(subject &s, int f, const std::vector<number> &results, detail with)
{
  recording first = R, all = R;
  std::vector<number> base = results;
  const auto is_loop = [](const graph &g) { return g.loops; };
  const bool loops = std::any_of(R.all.begin(), R.all.end(), is_loop); /* a turn may make iterations differ */
  if (loops) {
    with = FLAT;
    run(s, f, -1, base, nullptr, with);
    all = R;
  }
  std::map<std::uint64_t, const graph *> judged;
  for (graph &g : first.all) {
    const graph &kernel = g.loops ? first.all[(std::size_t)g.parent] : g;
    const std::uint64_t kind = g.loops ? mixed(kernel.kind, (std::uint64_t)g.call) : g.kind;
    const auto alike = judged.find(kind);
    for (std::size_t k = 0; k < g.guards.size(); k++) {
      guard &c = g.guards[k];
      std::vector<number> other;
      fb_status status = FB_OK;
      if (alike != judged.end() && kernel.kind != 0) {
        c.status = alike->second->guards[k].status;
        c.what = alike->second->guards[k].what;
        continue;
      }
      if (loops) { /* fast where it is refused */
        status = run(s, f, c.order, other, nullptr, PLAIN);
      }
      status = status == FB_OK ? run(s, f, c.order, other, nullptr, with) : status;
      c.status = status != FB_OK ? (int)status : gist(R, other, c.order) == gist(all, base, c.order) ? 0 : (int)BRANCH;
      if (status != FB_OK && fb_detail_last()->status == status && fb_detail_last()->what) {
        c.what = fb_detail_last()->what;
      }
    }
    judged.insert({kind, &g});
  }
  R = first;
}

/* Holds the graph against the library at other states: the same bits, or both refuse. Returns how many of 20 states
   it computes, ever nearer to the start until there are 5; or -1; strict: -2 where it is on the other side of a branch
   of one that the library computes. */
static int compare(subject &s, int f, const std::vector<number> &results, bool strict)
{
  int good = 0;
  for (int k = 0; k < 20 || (good < 5 && k < 160); k++) {
    std::vector<std::vector<double>> v(R.all.size());
    std::vector<entry> found;
    if (s.wander((0.2 + 0.1 * (k % 20)) * std::pow(0.25, k / 20)) != FB_OK) {
      continue;
    }
    const std::vector<double> inputs = s.values();
    const fb_status status = s.eval(f, found);
    model_now.clear();
    for (std::size_t i = inputs.size() - s.model.size(); i < inputs.size(); i++) {
      model_now.push_back((double)(real)inputs[i]);
    }
    const int own = values_at(v, 0, inputs);
    if (own == BRANCH && strict && status == FB_OK) {
      return -2;
    }
    if (own == BRANCH) {
      continue;
    }
    if ((own == 0) != (status == FB_OK)) {
      return -1;
    }
    for (std::size_t i = 0; i < results.size() && status == FB_OK; i++) {
      const double x = node_of(results[i]) ? v[0][(std::size_t)node_of(results[i])] : results[i].d;
      if (!(x == (double)*found[i].at)) {
        return -1;
      }
    }
    good += status == FB_OK;
  }
  return good;
}

/* A state at which the library answers, not far from the start. */
static bool find_state(subject &s, fb_status &status)
{
  for (double size = 1.0; size > 1e-4; size *= 0.5) {
    std::vector<entry> found;
    status = s.wander(size);
    status = status == FB_OK ? s.eval(0, found) : status;
    if (status == FB_OK) {
      return true;
    }
  }
  return false;
}

static int fail(char text[400], const std::string &what)
{
  std::snprintf(text, 400, "%s", what.c_str());
  return 1;
}

/* What the library refused last, with its reason where it has one. */
static std::string refused_by(fb_status status)
{
  const std::string what = fb_detail_last()->status == status ? fb_detail_last()->what : "";
  return std::string(fb_status_string(status)) + (what.empty() ? "" : " (" + what + ")");
}

} // namespace trace
#endif
