/* steps.h - the step of a body and what is read off its state, as C of its own. The structs, the names and the functions are those
   of code.h, which writes the declarations; the library's own functions, traced, are what stands in them. */
#ifndef TRACE_STEPS_H
#define TRACE_STEPS_H
#include "replay.h"
#include "text.h"
#include "trace.h"
#include <memory>

namespace trace
{

/* One function of what is written: its arguments are inputs, of which the library makes results. */
struct body_function : subject {
  enum kind { STEP, RATES, MOTION, ENERGY, NODE };
  const fb_body body;
  const kind is;
  const int node;
  fb_state now, next;
  fb_input acts[3];
  fb_motion motion;
  fb_energy energy;
  fb_node_motion place;
  fb_rk4_work work;
  number dt = 0.0;

  body_function(const trace_choice *choice, const fb_body &of, kind which, int at) : body(of), is(which), node(at)
  {
    static const char *const when[3] = {"start->", "middle->", "end->"};
    fb_state_init(&body, &now);
    std::memset(&acts, 0, sizeof acts);
    std::memset(&motion, 0, sizeof motion);
    add_members(input, now, "state->");
    for (int i = 0; i < 3 && (is == STEP || (is <= MOTION && i == 0)); i++) {
      add_input(choice, acts[i], is == STEP ? when[i] : "in->");
    }
    if (is == STEP) {
      input.push_back({"dt", &dt});
    }
    if (is == NODE) {
      add(input, motion.v, 3, "motion->v");
      add(input, motion.w, 3, "motion->w");
      add_list(input, motion.q_dot, body.n, "motion->q_dot");
    }
  }

  /* A list of a member is one in what is written, too, where it has one number. */
  static void add_list(std::vector<entry> &list, number *at, int n, const std::string &name)
  {
    for (int i = 0; i < n; i++) {
      list.push_back({name + "[" + std::to_string(i) + "]", at + i});
    }
  }

  void add_members(std::vector<entry> &list, fb_state &s, const std::string &to) const
  {
    const int n = body.n, rotors = body.n_rotor;
    add(list, s.rho, 3, to + "rho");
    add(list, s.quat, 4, to + "quat");
    add(list, s.u, 3, to + "u");
    add(list, s.L, 3, to + "L");
    add_list(list, s.q, n, to + "q");
    add_list(list, s.pi, n, to + "pi");
    add_list(list, s.q + n, rotors, to + "rotor_angle");
    add_list(list, s.pi + n, rotors, to + "rotor_momentum");
    add(list, s.lost_rho, 3, to + "lost_rho");
    add(list, s.lost_u, 3, to + "lost_u");
#if FB_SINGLE
    add(list, s.lost_quat, 4, to + "lost_quat");
    add(list, s.lost_L, 3, to + "lost_L");
    add(list, s.lost_h, 3, to + "lost_h");
    add_list(list, s.lost_q, n, to + "lost_q");
    add_list(list, s.lost_pi, n, to + "lost_pi");
    add_list(list, s.lost_q + n, rotors, to + "lost_rotor_angle");
    add_list(list, s.lost_pi + n, rotors, to + "lost_rotor_momentum");
#endif
  }

  void add_input(const trace_choice *choice, fb_input &in, const std::string &to)
  {
    for (int k = 0; k < body.n_node; k++) {
      if (k == 0 ? body.base == FB_BASE_PRESCRIBED : !(choice->loads[0] >> k & 1u)) {
        continue;
      }
      fb_load *const load = &in.load[in.n_load++];
      const std::string at = k > 0 ? "_" + std::to_string(k) : "";
      load->node = k;
      load->axes = FB_AXES_BODY;
      if (k > 0 || body.base == FB_BASE_FREE) {
        add(input, load->force, 3, to + "force" + at);
      }
      add(input, load->torque, 3, to + "torque" + at);
    }
    if (body.base == FB_BASE_PRESCRIBED) {
      add(input, in.v, 3, to + "v");
      add(input, in.w, 3, to + "w");
      if (is == STEP) {
        add(input, in.v_dot, 3, to + "v_dot");
      }
    }
    for (int k = 0; k < body.n_rotor; k++) {
      fb_rotor_input *const rotor = &in.rotor[k];
      add_list(input, body.rotor[k].given ? &rotor->momentum : &rotor->torque, 1, to + "rotor_motor");
      input.back().name = to + "rotor_motor[" + std::to_string(k) + "]";
    }
  }

  fb_status eval(int, std::vector<entry> &results) override
  {
    next = now;
    switch (is) {
    case STEP:
      FBI_TRY(fb_rk4_step(&body, &next, &work, &acts[0], &acts[1], &acts[2], dt));
      add_members(results, next, "state->");
      break;
    case RATES:
      FBI_TRY(fb_body_rates_eval(&body, &next, &now, &acts[0]));
      add_members(results, next, "rate->");
      for (entry &e : results) {
        *e.at = e.name.find("lost_") == std::string::npos ? *e.at : number(0.0);
      }
      break;
    case MOTION:
      FBI_TRY(fb_body_motion_eval(&body, &motion, &now, &acts[0]));
      add(results, motion.v, 3, "motion->v");
      add(results, motion.w, 3, "motion->w");
      add_list(results, motion.q_dot, body.n, "motion->q_dot");
      add_list(results, motion.rotor_speed, body.n_rotor, "motion->rotor_speed");
      break;
    case ENERGY:
      for (int k = 0; k < body.n_rotor; k++) { /* a given momentum is what the state has */
        acts[0].rotor[k].momentum = body.rotor[k].given ? now.pi[body.n + k] : number(0.0);
      }
      FBI_TRY(fb_body_energy_eval(&body, &energy, &now, &acts[0]));
      add(results, &energy.kinetic, 1, "energy->kinetic");
      add(results, &energy.strain, 1, "energy->strain");
      add(results, &energy.gravity, 1, "energy->gravity");
      break;
    case NODE:
      FBI_TRY(fb_body_node_motion_eval(&body, &place, &now, &motion, node));
      add(results, place.position, 3, "out->position");
      add(results, place.quat, 4, "out->quat");
      add(results, place.velocity, 3, "out->velocity");
      add(results, place.angular_rate, 3, "out->angular_rate");
      break;
    }
    return FB_OK;
  }

  fb_status wander(double size) override
  {
    const int n = body.n;
    fb_real v[3], w[3], q_dot[FB_MAX_MODES] = {};
    FBI_TRY(fb_state_init(&body, &now));
    for (const entry &e : input) {
      *e.at = size * random();
    }
    for (int i = 0; i < 3; i++) {
      const bool across = body.base == FB_BASE_HINGED && i < 2; /* of the hinge, along z */
      v[i] = body.base == FB_BASE_FREE || body.base == FB_BASE_PRESCRIBED ? size * random() : 0.0;
      w[i] = across ? 0.0 : 0.3 * size * random();
      now.rho[i] = body.base == FB_BASE_FREE ? random() : 0.0;
      now.quat[i + 1] = across ? 0.0 : 0.2 * random();
    }
    now.quat[0] = 1.0;
    FBI_TRY(fb_quat_normalize(now.quat));
    for (int a = 0; a < n; a++) {
      const double most = most_of(body, a, 0.2 * size);
      now.q[a] = most * random();
      q_dot[a] = most * random();
      motion.q_dot[a] = q_dot[a];
    }
    for (int k = 0; k < body.n_rotor; k++) {
      now.q[n + k] = 3.0 * random();
      now.pi[n + k] = size * random();
    }
    for (int i = 0; i < 3; i++) {
      for (int k = 0; k < 3 && body.base == FB_BASE_PRESCRIBED; k++) {
        acts[k].v[i] = v[i] + 1e-3 * size * random();
        acts[k].w[i] = w[i] + 1e-3 * size * random();
      }
      for (int k = 0; k < body.n_rotor; k++) {
        acts[i].rotor[k].momentum = body.rotor[k].given ? now.pi[n + k] : number(0.0);
      }
    }
    FBI_TRY(fb_state_from_velocity(&body, &now, v, w, q_dot));
    if (is == STEP) {
      const number limit = fb_rk4_limit(&body, 1.0, 1.0);
      dt = (0.05 + 0.45 * std::fabs(random())) * (limit < 1e3 ? (double)limit : 0.1);
    }
    for (const entry &e : input) {
      const bool lost = e.name.find("lost_") != std::string::npos,
                 pinned = e.name.find("lost_u") != std::string::npos &&
                          (body.base == FB_BASE_PINNED || body.base == FB_BASE_HINGED);
      *e.at = pinned ? number(0.0) : lost ? number(1e-17 * random()) : *e.at;
    }
    return FB_OK;
  }
};

/* A traced function, with what stands around it in the text. */
struct traced {
  std::string head, before, after; /* before: the results */
  recording made;
  std::vector<std::pair<std::string, number>> results;
  std::vector<std::string> names; /* of the inputs */
};

/* Traces a function; "", or why it cannot be written. */
static std::string trace_function(traced &t, subject &s, const std::string &name)
{
  std::vector<number> results;
  std::vector<std::string> names;
  fb_status status = FB_OK;
  if (!find_state(s, status)) {
    return name + ": no state near the start that the library steps: " + refused_by(status);
  }
  status = run(s, 0, -1, results, &names, true);
  if (status != FB_OK) {
    return name + ": " + refused_by(status);
  }
  if (R.conversions > 0) {
    return name + ": the library rounds a number of this model to a whole one";
  }
  judge_guards(s, 0, results, true);
  const int good = compare(s, 0, results, true);
  if (good < 5) {
    return name + (good == -2   ? ": the library branches on the state of this model"
                   : good == -1 ? ": what was traced differs from the library at another state"
                                : ": the library steps few states of this model");
  }
  t.made = R;
  for (std::size_t i = 0; i < results.size(); i++) {
    t.results.push_back({names[i], results[i]});
  }
  for (const entry &e : s.input) {
    t.names.push_back(e.name);
  }
  return "";
}

/* All functions of a file: kernels that they have in common are written once. */
struct file_of_functions {
  writer w;
  std::vector<traced> all;
  std::set<std::string> taken; /* names of kernels */

  static std::string status_name(const std::string &name, int status)
  {
    static const struct {
      int status;
      const char *name;
    } names[] = {{FB_ERR_NULL, "_null"},   {FB_ERR_VALUE, "_value"},          {FB_ERR_NOT_FINITE, "_not_finite"},
                 {FB_ERR_RANGE, "_range"}, {FB_ERR_STEP, "_step_length"},     {FB_ERR_SINGULAR, "_singular"},
                 {BRANCH, "_range"},       {FB_ERR_UNDETERMINED, "_singular"}};
    for (const auto &s : names) {
      if (s.status == status) {
        return name + s.name;
      }
    }
    return "(" + name + "_status)" + std::to_string(status);
  }

  /* The kernels that a function calls, and what it uses of them. */
  void collect(const recording &r, int graph_at, const std::vector<char> &live)
  {
    const graph &g = r.all[(std::size_t)graph_at];
    for (std::size_t i = 1; i < g.nodes.size(); i++) {
      if (!live[i] || g.nodes[i].op != 'r') {
        continue;
      }
      const graph &inner = r.all[(std::size_t)g.nodes[(std::size_t)node_of(g.nodes[i].a)].a.d];
      w.kernel[inner.kind].results[(int)g.nodes[i].b.d] = 0;
    }
  }

  /* Calls `what` with the recordings of all functions and each graph in them. */
  void write()
  {
    std::vector<std::pair<std::size_t, int>> order; /* of kernels: function, graph */
    std::set<std::uint64_t> seen;
    for (std::size_t f = 0; f < all.size(); f++) {
      R = all[f].made;
      std::vector<number> results;
      for (const auto &r : all[f].results) {
        results.push_back(r.second);
      }
      for (std::size_t g = 0; g < R.all.size(); g++) {
        collect(R, (int)g, g == 0 ? needed(R.all[0], results, true) : std::vector<char>(R.all[g].nodes.size(), 1));
        if (g > 0 && seen.insert(R.all[g].kind).second) {
          order.push_back({f, (int)g});
          kernel_text &k = w.kernel[R.all[g].kind];
          const std::string base =
              w.name + "_" + R.all[g].name.substr(R.all[g].name.compare(0, 4, "fbi_") == 0 ? 4 : 0);
          k.name = base;
          for (int number = 2; !taken.insert(k.name).second; number++) {
            k.name = base + "_" + std::to_string(number);
          }
        }
      }
    }
    for (auto &k : w.kernel) {
      int place = 0;
      for (auto &r : k.second.results) {
        r.second = place++;
      }
    }
    for (auto k = order.rbegin(); k != order.rend(); k++) { /* the innermost first */
      R = all[k->first].made;
      write_kernel(R.all[(std::size_t)k->second]);
    }
    for (const traced &t : all) {
      R = t.made;
      w.names = t.names;
      std::fprintf(w.out, "%s\n{\n%s", t.head.c_str(), t.before.c_str());
      w.body(R.all[0], t.results);
      std::fprintf(w.out, "%s  return %s_ok;\n}\n\n", t.after.c_str(), w.name.c_str());
    }
  }

  void write_kernel(const graph &g)
  {
    const kernel_text &k = w.kernel.at(g.kind);
    std::vector<std::pair<std::string, number>> results;
    const int at = (int)(&g - &R.all[0]);
    for (const auto &r : k.results) {
      results.push_back({"r[" + std::to_string(r.second) + "]", number_of(at, r.first)});
    }
    w.names.clear();
    for (int i = 0; i < g.n_input; i++) {
      w.names.push_back("a[" + std::to_string(i) + "]");
    }
    std::fprintf(w.out, "/* %s */\nstatic %s_status %s(%s *r, const %s *a)\n{\n", g.name.c_str(), w.name.c_str(),
                 k.name.c_str(), w.real.c_str(), w.real.c_str());
    w.body(g, results);
    std::fprintf(w.out, "  (void)r, (void)a;\n  return %s_ok;\n}\n\n", w.name.c_str());
  }
};

/* What computes without a number that is none may not notice it. */
static void write_finite(FILE *out, const std::string &n, const std::string &real, const fb_body &body)
{
  const bool single = sizeof(trace::real) == 4;
  const struct {
    const char *name;
    int n;
  } members[] = {{"rho", 3},
                 {"quat", 4},
                 {"u", 3},
                 {"L", 3},
                 {"q", body.n},
                 {"pi", body.n},
                 {"rotor_angle", body.n_rotor},
                 {"rotor_momentum", body.n_rotor}};
  std::fprintf(out, "static int %s_is_finite(const %s_state *s)\n{\n  %s sum = 0;\n", n.c_str(), n.c_str(),
               real.c_str());
  for (const auto &m : members) {
    if (m.n > 0) {
      std::fprintf(out, "  for (int i = 0; i < %d; i++) {\n    sum += %s(s->%s[i]);\n  }\n", m.n,
                   single ? "fabsf" : "fabs", m.name);
    }
  }
  std::fprintf(out, "  return sum <= %s;\n}\n\n", single ? "1e18f" : "1e150");
}

/* The functions of a body, whose declarations stand above; 0, or 1 with why in text. */
static int write_body_functions(FILE *out, const trace_choice *choice, const fb_body &body, char text[400])
{
  file_of_functions file;
  const std::string n = choice->name, real = choice->single ? "float" : "double";
  const std::string status = n + "_status ", state = "const " + n + "_state *state", in = "const " + n + "_input *";
  const std::string refuse_null = ") {\n    return " + n + "_null;\n  }\n",
                    refuse_state = "  if (!" + n + "_is_finite(state)) {\n    return " + n + "_not_finite;\n  }\n",
                    none = "  static " + n + "_input none; /* all zero */\n";
  file.w.out = out;
  file.w.name = n;
  file.w.real = real;
  file.w.single = choice->single;
  file.w.settled = true;
  file.w.status = [&](int s) { return file_of_functions::status_name(n, s); };
  const struct {
    body_function::kind is;
    std::string name, head, before;
  } functions[] = {
      {body_function::STEP, "_step",
       "(" + n + "_state *state, " + in + "start, " + in + "middle, " + in + "end, " + real + " dt)",
       none + "  if (!state" + refuse_null +
           "  start = start ? start : &none;\n  middle = middle ? middle : &none;\n  end = end ? end : &none;\n"},
      {body_function::RATES, "_rates_eval", "(" + n + "_state *rate, " + state + ", " + in + "in)",
       none + "  if (!rate || !state" + refuse_null + "  in = in ? in : &none;\n" + refuse_state},
      {body_function::MOTION, "_motion_eval", "(" + n + "_motion *motion, " + state + ", " + in + "in)",
       none + "  if (!motion || !state" + refuse_null + "  in = in ? in : &none;\n" + refuse_state},
      {body_function::ENERGY, "_energy_eval", "(" + n + "_energy *energy, " + state + ")",
       "  if (!energy || !state" + refuse_null + refuse_state}};
  for (const auto &f : functions) {
    if (f.is == body_function::ENERGY && body.base == FB_BASE_PRESCRIBED) {
      continue;
    }
    std::unique_ptr<body_function> s(new body_function(choice, body, f.is, 0));
    traced t;
    const std::string why = trace_function(t, *s, n + f.name);
    if (!why.empty()) {
      return fail(text, why);
    }
    t.head = status + n + f.name + f.head;
    t.before = f.before;
    file.all.push_back(t);
  }
  std::string cases;
  for (int k = 0; k < body.n_node; k++) {
    std::unique_ptr<body_function> s(new body_function(choice, body, body_function::NODE, k));
    traced t;
    const std::string name = n + "_node_" + std::to_string(k), why = trace_function(t, *s, name);
    if (!why.empty()) {
      return fail(text, why);
    }
    t.head = "static " + status + name + "(" + n + "_node *out, " + state + ", const " + n + "_motion *motion)";
    t.after = "  (void)motion;\n";
    file.all.push_back(t);
    cases += "  case " + std::to_string(k) + ":\n    return " + name + "(out, state, motion);\n";
  }
  write_finite(out, n, real, body);
  file.write();
  std::fprintf(
      out,
      "%s%s_node_eval(%s_node *out, %s, const %s_motion *motion, int node)\n{\n  if (!out || !state || !motion%s"
      "  switch (node) {\n%s  default:\n    return %s_value;\n  }\n}\n",
      status.c_str(), n.c_str(), n.c_str(), state.c_str(), n.c_str(), (refuse_null + refuse_state).c_str(),
      cases.c_str(), n.c_str());
  return 0;
}

} // namespace trace
#endif
