/* trace.cpp - the rates of a model and their Jacobian as C of its own: reduce --jacobian, scene --jacobian. The library itself
   computes them, with numbers that remember how they were made (number.h, graph.h); what it checks on the way is checked
   in what is written, with the same status. Before anything is written the graph is held against the library at other
   states, where it has to give the same bits. */
#include "../capacities.h"
#include "number.h"
#define FB_WITH_EXACT 0
#define FB_WITH_ANALYSE 0
#define FB_ALLOW_FAST_MATH /* the check for it computes with numbers of the machine */
#define FLEXBEAM_STATIC
/* the library whose numbers are a class takes minutes to optimize */
#ifdef __clang__
#pragma clang optimize off
#include "../../../flexbeam.h"
#pragma clang optimize on
#else
#pragma GCC push_options
#pragma GCC optimize("O0")
#include "../../../flexbeam.h"
#pragma GCC pop_options
#endif
#include "body_steps.h"
#include "derive.h"
#include "replay.h"
#include "tree_steps.h"
#include "loop_text.h"
#include "trace.h"
#include <cctype>

namespace trace
{

/* What an inertial measurement unit, a star tracker and a receiver at a node see: E8.30. */
static fb_status sense(std::vector<entry> &results, const fb_body *body, const fb_state *state, const fb_motion *motion,
                       int node)
{
  static fb_node_motion at;
  static fb_imu imu;
  fb_real g[3];
  FBI_TRY(fb_body_node_motion_eval(body, &at, state, motion, node));
  FBI_TRY(fb_body_gravity_eval(body, g, at.position));
  fb_imu_eval(&imu, &at, g);
  subject::add(results, imu.angular_rate, 3, "angular_rate");
  subject::add(results, imu.specific_force, 3, "specific_force");
  subject::add(results, at.quat, 4, "quat");
  subject::add(results, at.position, 3, "position");
  subject::add(results, at.velocity, 3, "velocity");
  return FB_OK;
}

static std::string node_text(const trace_choice *choice, int body, int node)
{
  const char *const name = node > 0 ? choice->node_name(body, node) : "O";
  const std::string own = name[0] ? name : "node_" + std::to_string(node);
  std::string all = choice->body ? std::string(choice->body[body]) + (node > 0 ? "_" + own : "") : own;
  for (char &c : all) { /* part of the name of a function */
    c = std::strchr("+-. ", c) ? '_' : c;
  }
  return all;
}

/* ---- a single body */

struct single_body : subject {
  fb_body given, body; /* as described, as it varies */
  fb_body_factors by;
  std::unique_ptr<fb_body_work> work{new fb_body_work};
  int vary;
  fb_state now, rate;
  fb_input acts;
  fb_motion motion;
  std::vector<int> node; /* of the sensors */

  single_body(const trace_choice *choice, const trace_model *model)
  {
    std::memcpy(&given, model->body, sizeof given);
    body = given;
    fb_state_init(&body, &now);
    std::memset(&acts, 0, sizeof acts);
    add(state, now.rho, 3, "rho");
    add_quaternion(now.quat, "quat");
    add(state, now.u, 3, "u");
    add(state, now.L, 3, "L");
    bent.push_back({(int)state.size(), &body});
    add(state, now.q, body.n_coordinate, "q");
    add(state, now.pi, body.n_coordinate, "pi");
    for (int k = 0; k < body.n_node; k++) {
      const std::string name = node_text(choice, 0, k);
      if (k == 0 || node_is_in(&choice->loads[0], k)) {
        fb_load *const load = &acts.load[acts.n_load++];
        load->node = k;
        load->axes = FB_AXES_BODY;
        add(input, load->force, 3, name + ".force");
        add(input, load->torque, 3, name + ".torque");
      }
      if (node_is_in(&choice->sensors[0], k)) {
        node.push_back(k);
        sensor.push_back(name);
      }
    }
    if (body.base == FB_BASE_PRESCRIBED) {
      add(input, acts.v, 3, "v");
      add(input, acts.w, 3, "w");
      add(input, acts.v_dot, 3, "v_dot");
      add(input, acts.w_dot, 3, "w_dot");
    }
    for (int k = 0; k < body.n_rotor; k++) {
      add(input, &acts.rotor[k].torque, 1, "rotor_torque_" + std::to_string(k));
      if (body.rotor[k].given) {
        add(input, &acts.rotor[k].momentum, 1, "rotor_momentum_" + std::to_string(k));
      }
    }
    vary = choice->vary;
    std::memset(&by, 0, sizeof by);
    by.stiffness = by.damping = by.mass = by.hub_mass = by.hub_inertia = 1.0;
    for (int k = 0; k < 2; k++) {
      if (vary >> k & 1) {
        add(input, k == 0 ? &by.stiffness : &by.damping, 1, k == 0 ? "stiffness" : "damping");
      }
    }
  }

  fb_status eval(int function, std::vector<entry> &results) override
  {
    if (vary) {
      FBI_TRY(fb_body_scale(&body, work.get(), &given, &by));
    }
    if (function > 0) {
      FBI_TRY(fb_body_motion_eval(&body, &motion, &now, &acts));
      return sense(results, &body, &now, &motion, node[(std::size_t)function - 1]);
    }
    FBI_TRY(fb_body_rates_eval(&body, &rate, &now, &acts));
    for (const entry &e : state) { /* the same members */
      results.push_back({e.name, (number *)((char *)&rate + ((char *)e.at - (char *)&now))});
    }
    return FB_OK;
  }

  fb_status wander(double size) override
  {
    fb_real v[3], w[3], q_dot[FB_MAX_MODES];
    FBI_TRY(fb_state_init(&body, &now));
    for (int i = 0; i < 3; i++) {
      const int held = body.base == FB_BASE_FREE ? 0 : body.base == FB_BASE_HINGED && i == 2 ? 1 : 2;
      v[i] = held == 0 || body.base == FB_BASE_PRESCRIBED ? size * random() : 0.0;
      w[i] = body.base == FB_BASE_HINGED && i < 2 ? 0.0 : 0.3 * size * random();
      now.rho[i] = body.base == FB_BASE_FREE ? random() : 0.0;
      now.quat[i + 1] = body.base == FB_BASE_HINGED && i < 2 ? 0.0 : 0.2 * random();
    }
    FBI_TRY(fb_quat_normalize(now.quat));
    for (int a = 0; a < body.n; a++) {
      const double most = most_of(body, a, 0.2 * size);
      now.q[a] = most * random();
      q_dot[a] = most * random();
    }
    for (const entry &e : input) {
      *e.at = size * random();
    }
    for (int k = 0; k < 2; k++) {
      (k == 0 ? by.stiffness : by.damping) = vary >> k & 1 ? 1.0 + 0.1 * random() : 1.0;
    }
    if (body.base == FB_BASE_PRESCRIBED) {
      std::memcpy(acts.v, v, sizeof v);
      std::memcpy(acts.w, w, sizeof w);
    }
    return fb_state_from_velocity(&body, &now, v, w, q_dot);
  }
};

/* ---- bodies on joints */

struct tree : subject {
  std::vector<fb_body> body;
  fb_system system;
  fb_system_state start, now, rate;
  fb_system_input acts;
  fb_system_motion motion;
  std::unique_ptr<fb_system_work> work{new fb_system_work};
  std::vector<std::pair<int, int>> place; /* body and node of the sensors */

  tree(const trace_choice *choice, const trace_model *model) : body((std::size_t)model->n_body)
  {
    std::memcpy(&body[0], model->body, sizeof body[0] * body.size());
    std::memcpy(&system, model->system, sizeof system);
    std::memcpy(&start, model->state, sizeof start);
    now = start;
    std::memset(&acts, 0, sizeof acts);
    std::memset(work.get(), 0, sizeof *work);
    for (int k = 0; k < system.n_body; k++) {
      add_link(choice, k);
    }
    for (int k = 0; k < system.n_spring; k++) {
      add(input, &acts.pull[k], 1, "pull_" + std::to_string(k));
    }
  }

  const fb_body &model_of(int k) const
  {
    return body[(std::size_t)system.model[k]];
  }

  void add_link(const trace_choice *choice, int k)
  {
    const fb_joint &joint = system.joint[k];
    const fb_body &own = model_of(k);
    const std::string name = choice->body[k];
    fb_link_state &link = now.link[k];
    const bool root = joint.kind == FB_JOINT_FREE, ball = joint.kind == FB_JOINT_SPHERICAL;
    if (!ball) {
      add(state, link.x, root ? 3 : joint.n_axis, name + ".x");
    }
    if (root || ball) {
      add_quaternion(link.quat, name + ".quat");
    }
    if (root && !system.tied) {
      add(state, link.u, 3, name + ".u");
    }
    add(state, link.p, joint.n_axis, name + ".p");
    bent.push_back({(int)state.size(), &own});
    add(state, link.q, own.n_coordinate, name + ".q");
    add(state, link.pi, own.n_coordinate, name + ".pi");
    for (int node = 0; node < own.n_node; node++) {
      const std::string at = node_text(choice, k, node);
      if (node_is_in(&choice->loads[k], node)) {
        fb_system_load *const load = &acts.load[acts.n_load++];
        load->body = k;
        load->load.node = node;
        load->load.axes = FB_AXES_BODY;
        add(input, load->load.force, 3, at + ".force");
        add(input, load->load.torque, 3, at + ".torque");
      }
      if (node_is_in(&choice->sensors[k], node)) {
        place.push_back({k, node});
        sensor.push_back(at);
      }
    }
    for (int i = 0; i < joint.n_axis; i++) {
      const int mode = now.mode[k][root ? 0 : i];
      const std::string axis = joint.n_axis > 1 ? "[" + std::to_string(i) + "]" : "";
      if (mode == FB_AXIS_PRESCRIBED) {
        add(input, &acts.drive[k].rate[i], 1, name + ".rate" + axis);
        add(input, &acts.drive[k].acceleration[i], 1, name + ".acceleration" + axis);
      } else if (mode == FB_AXIS_FREE && !root) {
        add(input, &acts.drive[k].torque[i], 1, name + ".motor" + axis);
      }
    }
    for (int j = 0; j < own.n_rotor; j++) {
      const std::string rotor = name + ".rotor_" + std::to_string(j);
      add(input, &acts.rotor[k][j].torque, 1, rotor + ".torque");
      if (own.rotor[j].given) {
        add(input, &acts.rotor[k][j].momentum, 1, rotor + ".momentum");
      }
    }
  }

  fb_status eval(int function, std::vector<entry> &results) override
  {
    if (function > 0) {
      const auto &at = place[(std::size_t)function - 1];
      FBI_TRY(fb_system_motion_eval(&system, &body[0], work.get(), &motion, &now, &acts));
      return sense(results, &model_of(at.first), &motion.pose[at.first], &motion.motion[at.first], at.second);
    }
    FBI_TRY(fb_system_rates_eval(&system, &body[0], work.get(), &rate, &now, &acts));
    for (const entry &e : state) {
      results.push_back({e.name, (number *)((char *)&rate + ((char *)e.at - (char *)&now))});
    }
    return FB_OK;
  }

  fb_status wander(double size) override
  {
    FBI_TRY(wander_links(*this, system, &body[0], now, start, size));
    for (const entry &e : input) {
      *e.at = 0.1 * size * random();
    }
    return FB_OK;
  }
};

/* ---- what is written */

static void write_list(FILE *out, const std::string &name, const char *what, const std::vector<entry> &list)
{
  std::fprintf(out, "/* %s */\nstatic const char *const %s[%d] = {%s", what, name.c_str(),
               list.empty() ? 1 : (int)list.size(), list.empty() ? "0" : "");
  for (std::size_t i = 0; i < list.size(); i++) {
    std::fprintf(out, "%s\"%s\"%s", i % 6 ? " " : "\n    ", list[i].name.c_str(), i + 1 < list.size() ? "," : "");
  }
  std::fprintf(out, "};\n\n");
}

/* A list of numbers that a float or a double reads back. */
static void write_numbers(FILE *out, const trace_choice *choice, const char *name, const char *what,
                          const std::vector<double> &list)
{
  std::fprintf(out, "/* %s */\nstatic const %s_real %s_%s[%d] = {", what, choice->name, choice->name, name,
               (int)list.size());
  for (std::size_t i = 0; i < list.size(); i++) {
    const char *const apart = i % 6 ? ", " : i ? ",\n    " : "\n    ";
    std::fprintf(out, "%s%.*e%s", apart, choice->single ? 8 : 16, list[i], choice->single ? "f" : "");
  }
  std::fprintf(out, "};\n\n");
}

/* start: state at which the scene starts; the body at rest. */
static void write_head(FILE *out, const trace_choice *choice, const subject &s, const std::vector<double> &start)
{
  const char *const n = choice->name, *const real = choice->single ? "float" : "double";
  std::string file = choice->file;
  for (std::size_t i = 0; i < file.size(); i++) { /* it stays in the comment */
    file[i] = std::iscntrl((unsigned char)file[i]) || (i > 0 && file[i - 1] == '*' && file[i] == '/') ? '_' : file[i];
  }
  std::fprintf(out, "/* %s - rates, sensors and a step with their exact Jacobians, written by flexbeam from %s.\n", n,
               file.c_str());
  std::fprintf(
      out,
      "   The rates are those of the library, operation by operation, with its checks; their derivatives are exact. A\n"
      "   function returns 0, or the status of the library (fb_status) and leaves its results as they were; "
      "%s_ERR_BRANCH: the\n"
      "   state is on the other side of a branch of the library than the one that was traced. A Jacobian is a list of\n"
      "   entries: number e stands in the row and the column that its table says; columns are states, then inputs. "
      "*/\n",
      n);
  std::fprintf(out, "#ifndef %s_JACOBIAN_H\n#define %s_JACOBIAN_H\n#include <math.h>\n\n", n, n);
  std::fprintf(out, "typedef %s %s_real;\n", real, n);
  std::fprintf(out, "enum { %s_STATES = %d, %s_INPUTS = %d, %s_ERR_BRANCH = %d };\n\n", n, (int)s.state.size(), n,
               (int)s.input.size(), n, (int)BRANCH);
  write_list(out, std::string(n) + "_state",
             "x, as members of the library's state; in q and pi rotors, their angles and momenta, follow the modes",
             s.state);
  write_list(out, std::string(n) + "_input", "u; forces and torques in body axes", s.input);
  write_numbers(out, choice, "start", "x at the start of the scene; of a single body, at rest.", start);
  write_numbers(out, choice, "near", "A state near which it was traced, and inputs.", s.values());
}

/* A function of a model without and with its Jacobian, and the table of its entries. */
static void write_function(writer &w, const std::string &name, const std::string &what,
                           const std::vector<number> &results)
{
  const char *const n = name.c_str(), *const real = w.real.c_str(),
                    *const end = "  (void)x, (void)u;\n  return 0;\n}\n\n";
  std::vector<std::pair<std::string, number>> lines;
  std::vector<std::pair<int, int>> at;
  for (std::size_t i = 0; i < results.size(); i++) {
    lines.push_back({"y[" + std::to_string(i) + "]", results[i]});
  }
  std::fprintf(w.out, "/* %s */\nstatic inline int %s(%s *y, const %s *x, const %s *u)\n{\n", what.c_str(), n, real,
               real, real);
  w.body(R.all[0], lines);
  std::fprintf(w.out, "%s", end);

  /* derivatives are appended to the graph */
  R.on = true;
  const std::vector<gradient> J = differentiate(results);
  R.on = false;
  for (std::size_t i = 0; i < J.size(); i++) {
    for (const auto &e : J[i]) {
      lines.push_back({"J[" + std::to_string(at.size()) + "]", e.second});
      at.push_back({(int)i, e.first});
    }
  }
  std::fprintf(w.out, "enum { %s_entries = %d };\nstatic const unsigned short %s_at[%d][2] = { /* row, column */", n,
               (int)at.size(), n, at.empty() ? 1 : (int)at.size());
  for (std::size_t i = 0; i < at.size(); i++) {
    std::fprintf(w.out, "%s{%d, %d}%s", i % 12 ? " " : "\n    ", at[i].first, at[i].second,
                 i + 1 < at.size() ? "," : "");
  }
  std::fprintf(w.out, "%s};\nstatic inline int %s_jacobian(%s *y, %s *J, const %s *x, const %s *u)\n{\n",
               at.empty() ? "{0, 0}" : "", n, real, real, real, real);
  if (at.empty()) {
    std::fprintf(w.out, "  (void)J;\n");
  }
  w.body(R.all[0], lines);
  std::fprintf(w.out, "%s", end);
}

/* The step: no arithmetic of the model's own. */
static void write_step(writer &w, const subject &s)
{
  static const char *const text =
      "/* One step of dt [s] of the classical Runge-Kutta method under inputs that stay: x becomes the state at its "
      "end, Phi\n"
      "   its derivative by the state at the start, Gamma that by the inputs, row by row. Attitudes are unit "
      "quaternions\n"
      "   again. On a status x, Phi and Gamma stay as they were: of the rates, or what is not finite or beyond the "
      "deflection\n"
      "   limit at the end. dt is not held against a limit: choose it below that of fb_rk4_step. */\n"
      "typedef struct @_work { /* room for a step; what is in it does not matter */\n"
      "  @_real y[@_STATES], k[@_STATES], sum[@_STATES], J[@_rates_entries];\n"
      "  @_real P[@_STATES][@_STATES + @_INPUTS], K[@_STATES][@_STATES + @_INPUTS], S[@_STATES][@_STATES + @_INPUTS];\n"
      "} @_work;\n"
      "\n"
      "static inline int @_step_jacobian(@_real *x, @_real *Phi, @_real *Gamma, @_work *w, const @_real *u, @_real "
      "dt)\n"
      "{\n"
      "  static const @_real ahead[4] = {0, $, $, 1}, weight[4] = {1, 2, 2, 1};\n"
      "  enum { n = @_STATES, all = @_STATES + @_INPUTS };\n"
      "  for (int i = 0; i < n; i++) {\n"
      "    w->k[i] = w->sum[i] = 0;\n"
      "    for (int j = 0; j < all; j++) {\n"
      "      w->K[i][j] = w->S[i][j] = 0;\n"
      "    }\n"
      "  }\n"
      "\n"
      "  /* stages: rates at y = x + ahead dt k, K = J P with P = dy/d(x, u) */\n"
      "  for (int stage = 0; stage < 4; stage++) {\n"
      "    int status;\n"
      "    for (int i = 0; i < n; i++) {\n"
      "      w->y[i] = x[i] + ahead[stage] * dt * w->k[i];\n"
      "      for (int j = 0; j < all; j++) {\n"
      "        w->P[i][j] = (i == j ? 1 : 0) + ahead[stage] * dt * w->K[i][j];\n"
      "        w->K[i][j] = 0;\n"
      "      }\n"
      "    }\n"
      "    status = @_rates_jacobian(w->k, w->J, w->y, u);\n"
      "    if (status) {\n"
      "      return status;\n"
      "    }\n"
      "    for (int e = 0; e < @_rates_entries; e++) {\n"
      "      const int i = @_rates_at[e][0], c = @_rates_at[e][1];\n"
      "      for (int j = 0; j < all && c < n; j++) {\n"
      "        w->K[i][j] += w->J[e] * w->P[c][j];\n"
      "      }\n"
      "      if (c >= n) {\n"
      "        w->K[i][c] += w->J[e];\n"
      "      }\n"
      "    }\n"
      "    for (int i = 0; i < n; i++) {\n"
      "      w->sum[i] += weight[stage] * w->k[i];\n"
      "      for (int j = 0; j < all; j++) {\n"
      "        w->S[i][j] += weight[stage] * w->K[i][j];\n"
      "      }\n"
      "    }\n"
      "  }\n"
      "\n"
      "  /* the end of the step */\n"
      "  for (int i = 0; i < n; i++) {\n"
      "    w->y[i] = x[i] + dt / 6 * w->sum[i];\n"
      "    for (int j = 0; j < all; j++) {\n"
      "      w->P[i][j] = (i == j ? 1 : 0) + dt / 6 * w->S[i][j];\n"
      "    }\n"
      "  }\n"
      "  for (int a = 0; a < @_QUATERNIONS; a++) {\n"
      "    const int at = @_quaternion[a];\n"
      "    @_real *const q = w->y + at, size = ^(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);\n"
      "    for (int i = 0; i < 4; i++) {\n"
      "      q[i] /= size;\n"
      "    }\n"
      "    for (int j = 0; j < all; j++) { /* d(q/|q|) = (1 - q q') dq / |q| */\n"
      "      const @_real along =\n"
      "          q[0] * w->P[at][j] + q[1] * w->P[at + 1][j] + q[2] * w->P[at + 2][j] + q[3] * w->P[at + 3][j];\n"
      "      for (int i = 0; i < 4; i++) {\n"
      "        w->P[at + i][j] = (w->P[at + i][j] - along * q[i]) / size;\n"
      "      }\n"
      "    }\n"
      "  }\n"
      "\n"
      "  /* finite, within the deflection limit */\n"
      "  for (int i = 0; i < n; i++) {\n"
      "    @_real sum = w->y[i];\n"
      "    for (int j = 0; j < all; j++) {\n"
      "      sum += w->P[i][j] - w->P[i][j];\n"
      "    }\n"
      "    if (!(sum - sum == 0)) {\n"
      "      return %;\n"
      "    }\n"
      "  }\n"
      "~"
      "  for (int i = 0; i < n; i++) {\n"
      "    x[i] = w->y[i];\n"
      "    for (int j = 0; j < all; j++) {\n"
      "      *(j < n ? Phi++ : Gamma++) = w->P[i][j];\n"
      "    }\n"
      "  }\n"
      "  return 0;\n"
      "}\n\n";
  std::fprintf(
      w.out, "/* Where attitudes begin in x. */\nenum { %s_QUATERNIONS = %d };\nstatic const int %s_quaternion[%d] = {",
      w.name.c_str(), (int)s.quaternion.size(), w.name.c_str(), s.quaternion.empty() ? 1 : (int)s.quaternion.size());
  for (std::size_t i = 0; i < s.quaternion.size(); i++) {
    std::fprintf(w.out, "%s%d", i ? ", " : "", s.quaternion[i]);
  }
  std::fprintf(w.out, "%s};\n\n", s.quaternion.empty() ? "0" : "");
  std::string range;
  for (const auto &b : s.bent) { /* as the library: the sum over the modes of a body */
    std::string sum;
    for (int a = 0; a < b.second->n; a++) {
      const double reach = (double)b.second->reach[a];
      if (reach > 0.0) {
        sum += (sum.empty() ? "" : " +\n        ") + w.constant(reach) + " * " + (w.single ? "fabsf" : "fabs") +
               "(w->y[" + std::to_string(b.first + a) + "])";
      }
    }
    if (!sum.empty()) {
      range += "  if (!(" + sum + "\n        <= " + w.constant((double)b.second->deflection_limit) +
               ")) {\n    return " + std::to_string((int)FB_ERR_RANGE) + ";\n  }\n";
    }
  }
  for (const char *c = text; *c; c++) {
    const std::string part = *c == '@'   ? w.name
                             : *c == '$' ? (w.single ? "0.5f" : "0.5")
                             : *c == '^' ? (w.single ? "sqrtf" : "sqrt")
                             : *c == '%' ? std::to_string((int)FB_ERR_NOT_FINITE)
                             : *c == '~' ? range
                                         : std::string(1, *c);
    std::fputs(part.c_str(), w.out);
  }
}

/* What cannot be traced; NULL: all can. */
static const char *refusal(const trace_model *model, bool lines)
{
  const fb_body *const body = (const fb_body *)model->body;
  const fb_system *const system = (const fb_system *)model->system;
  if (model->body_size != sizeof(fb_body) || (system && model->system_size != sizeof(fb_system)) ||
      (system && model->state_size != state_size())) {
    return "the tracer was built with another configuration of the library; make it again";
  }
  for (int k = 0; k < model->n_body; k++) {
    if (body[k].effects & FB_EFFECT_LARGE_DEFLECTION && !lines) {
      return "effects large: loops over the points of lines are not written; choose effects up to full";
    }
  }
  return system && system->method != FB_METHOD_RECURSIVE ? "method: choose recursive" : nullptr;
}

/* Two names that a sensor would have in common with another, or none. */
static std::string namesakes(const subject &s)
{
  std::map<std::string, std::string> taken;
  for (const std::string &name : s.sensor) {
    for (const char *end : {"", "_jacobian", "_entries", "_at"}) {
      const auto found = taken.insert({name + end, name});
      if (!found.second) {
        return "--sensors: " + found.first->second + " and " + name + " would both have sense_" + name + end +
               "; give a node another name";
      }
    }
  }
  return "";
}

static int write(FILE *out, const trace_choice *choice, subject &s, char text[400])
{
  writer w;
  w.out = out;
  w.name = choice->name;
  w.real = w.name + "_real";
  w.single = choice->single;
  w.given.assign(s.state.size() + s.input.size(), 0u); /* all are */
  w.status = [&](int status) { return status == BRANCH ? w.name + "_ERR_BRANCH" : std::to_string(status); };
  for (std::size_t i = 0; i < s.state.size() + s.input.size(); i++) {
    w.names.push_back(i < s.state.size() ? "x[" + std::to_string(i) + "]"
                                         : "u[" + std::to_string(i - s.state.size()) + "]");
  }
  fb_status status = FB_OK;
  if (s.state.empty()) {
    return fail(text, "nothing of it moves: it has no state");
  }
  if (!namesakes(s).empty()) {
    return fail(text, namesakes(s));
  }
  std::vector<double> start = s.values();
  start.resize(s.state.size());
  if (!find_state(s, status)) {
    return fail(text, "no state near the start that the library steps: " + refused_by(status));
  }
  const std::vector<double> near = s.values();
  write_head(out, choice, s, start);
  for (int f = 0; f <= (int)s.sensor.size(); f++) {
    std::vector<number> results;
    std::vector<std::string> names;
    const std::string name = f == 0 ? "rates" : "sense_" + s.sensor[(std::size_t)f - 1];
    s.set(near);
    status = run(s, f, -1, results, &names, FLAT);
    if (status != FB_OK) {
      return fail(text, name + ": " + refused_by(status));
    }
    if (R.conversions > 0) {
      return fail(text, name + ": the library rounds a number of this model to a whole one, which has no derivative");
    }
    judge_guards(s, f, results, FLAT);
    const int good = compare(s, f, results, false);
    if (good < 10) {
      return fail(text, name + (good < 0 ? ": what was traced differs from the library at another state"
                                         : ": the library branches on the state of this model"));
    }
    std::string what = f == 0 ? "Rates of x: y[" + std::to_string(results.size()) + "]."
                              : "What is seen at " + s.sensor[(std::size_t)f - 1] + ":";
    for (std::size_t i = 0; f > 0 && i < names.size(); i++) {
      what += (i ? ", " : " ") + names[i];
    }
    write_function(w, w.name + "_" + name, what, results);
  }
  write_step(w, s);
  std::fprintf(out, "#endif\n");
  return 0;
}

} // namespace trace

#if FB_SINGLE
#define TRACE_STEP trace_step_single
#define TRACE_PLACES trace_places_single
#else
#define TRACE_STEP trace_step
#define TRACE_PLACES trace_places
extern "C" int trace_write(FILE *out, const trace_choice *choice, const trace_model *model, char text[400])
{
  const char *const refused = trace::refusal(model, false);
  std::unique_ptr<trace::subject> s;
  if (refused) {
    return trace::fail(text, refused);
  }
  if (model->system && ((const fb_system *)model->system)->n_loop > 0) {
    return trace::fail(text, "loops: the choice of independent rows has no derivative; open the loop by springs");
  }
  if (model->system) {
    s.reset(new trace::tree(choice, model));
  } else {
    s.reset(new trace::single_body(choice, model));
  }
  return trace::write(out, choice, *s, text);
}
#endif

extern "C" int TRACE_STEP(FILE *out, const trace_choice *choice, const trace_model *model, char text[400])
{
  const char *const refused = trace::refusal(model, true);
  return refused         ? trace::fail(text, refused)
         : model->system ? trace::write_tree_functions(out, choice, model, text)
                         : trace::write_body_functions(out, choice, *(const fb_body *)model->body, text);
}

extern "C" int TRACE_PLACES(const trace_choice *choice, const trace_model *model)
{
  std::unique_ptr<trace::scaling> s(new trace::scaling(choice, *(const fb_body *)model->body));
  return s->table.offset.empty() ? 1 : (int)s->table.offset.size();
}
