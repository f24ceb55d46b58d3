/* tree_steps.h - the step of bodies on joints and what is read off its state, as C of its own. The structs, the names and the
   functions are those of code_tree.h, which writes the declarations. */
#ifndef TRACE_TREE_STEPS_H
#define TRACE_TREE_STEPS_H
#include "steps.h"

namespace trace
{

/* Numbers of a double-precision state: where the copy of a model that is in double precision has them. */
static void take_start(fb_system_state &start, const void *from)
{
#if FB_SINGLE
  const std::size_t own = offsetof(fb_link_state, lost_quat), rest = offsetof(fb_system_state, motor_work);
  std::memset(&start, 0, sizeof start);
  for (int k = 0; k < FB_MAX_BODIES; k++) {
    std::memcpy(&start.link[k], (const char *)from + (std::size_t)k * own, own);
  }
  std::memcpy((char *)&start + rest, (const char *)from + FB_MAX_BODIES * own, sizeof start - rest);
#else
  std::memcpy(&start, from, sizeof start);
#endif
}

/* Size of the caller's fb_system_state. */
static std::size_t state_size()
{
#if FB_SINGLE
  return sizeof(fb_system_state) - FB_MAX_BODIES * (sizeof(fb_link_state) - offsetof(fb_link_state, lost_quat));
#else
  return sizeof(fb_system_state);
#endif
}

struct tree_model {
  std::vector<fb_body> body;
  fb_system system;
  fb_system_state start;

  tree_model(const trace_model *model) : body((std::size_t)model->n_body)
  {
    std::memcpy(&body[0], model->body, sizeof body[0] * body.size());
    std::memcpy(&system, model->system, sizeof system);
    take_start(start, model->state);
  }

  /* The table of a subject. */
  void bind(subject &s, const trace_table *table)
  {
    const std::size_t bodies = sizeof body[0] * body.size();
    s.model.resize(table ? (std::size_t)table->n_place : 0);
    for (int i = 0; table && i < table->n; i++) {
      char *const from = table->offset[i] < bodies ? (char *)&body[0] : (char *)&system - bodies;
      if (table->place[i] >= 0) {
        s.model[(std::size_t)table->place[i]].push_back((number *)(from + table->offset[i]));
      }
    }
  }

  const fb_body &of(int k) const
  {
    return body[(std::size_t)system.model[k]];
  }

  bool is_root(int k) const
  {
    return system.joint[k].kind == FB_JOINT_FREE;
  }

  /* Have prescribed axes of a joint values? */
  bool has_value(int k) const
  {
    return system.joint[k].kind != FB_JOINT_SPHERICAL && !is_root(k);
  }

  /* Axes of a joint of that mode; a free one has none. */
  int count(int k, fb_axis_mode mode) const
  {
    int n = 0;
    for (int i = 0; i < system.joint[k].n_axis && !is_root(k); i++) {
      n += start.mode[k][i] == mode;
    }
    return n;
  }
};

struct tree_function : subject {
  enum kind { STEP, MOTION, ENERGY, NODE };
  tree_model &tree;
  const kind is;
  const int part, node; /* of NODE */
  fb_system_state now, next;
  fb_system_input acts[3];
  fb_system_motion motion;
  fb_energy energy;
  number given[FBI_MAX_JOINTS][3]; /* prescribed values of loops, whose state has none */
  std::unique_ptr<fb_system_work> work{new fb_system_work};
  std::vector<double> described; /* its numbers that vary */
  number dt = 0.0;
  number R[FB_MAX_BODIES][9];
  fb_state pose;
  fb_motion moves;
  fb_node_motion place;

  tree_function(const trace_choice *choice, tree_model &of, kind which, int body, int at)
      : tree(of), is(which), part(body), node(at)
  {
    static const char *const when[3] = {"start->", "middle->", "end->"};
    reads = is != STEP;
    tree.bind(*this, choice->table);
    described = values();
    now = tree.start;
    std::memset(&acts, 0, sizeof acts);
    std::memset(work.get(), 0, sizeof *work);
    std::memset(&pose, 0, sizeof pose);
    std::memset(&moves, 0, sizeof moves);
    if (is == NODE) {
      const std::string at_body = "body_" + std::to_string(body);
      add_list(input, now.link[body].q, tree.of(body).n, "state->" + at_body + ".q");
      add(input, pose.rho, 3, "motion->" + at_body + ".position");
      add(input, R[0], 9, "motion->" + at_body + ".R");
      add(input, moves.v, 3, "motion->" + at_body + ".v");
      add(input, moves.w, 3, "motion->" + at_body + ".w");
      add_list(input, moves.q_dot, tree.of(body).n, "motion->" + at_body + ".q_dot");
      return;
    }
    add_members(choice, input, now, "state->");
    for (int i = 0; i < 3 && (is == STEP || i == 0); i++) {
      if (i != 1 || !choice->implicit) {
        add_input(choice, acts[i], is == STEP ? when[i] : "in->");
      }
    }
    if (is == STEP) {
      input.push_back({"dt", &dt});
    }
  }

  /* Has a state the work of motors? */
  bool has_work(const trace_choice *choice) const
  {
    bool any = false;
    for (int k = 0; k < tree.system.n_body; k++) {
      any = any || tree.count(k, FB_AXIS_FREE) > 0 || tree.of(k).n_rotor > 0;
    }
    for (int j = 0; j < tree.system.n_spring; j++) {
      any = any || choice->pulls[j];
    }
    return any;
  }

  /* A member of a link with what it has lost by rounding, in single precision. */
  static void add_member(std::vector<entry> &list, number *at, number *lost, int n, const std::string &to,
                         const char *name)
  {
    add_list(list, at, n, to + name);
#if FB_SINGLE
    add_list(list, lost, n, to + "lost_" + name);
#endif
    (void)lost;
  }

#if FB_SINGLE
#define TRACE_LOST(link, member) (link).lost_##member
#else
#define TRACE_LOST(link, member) nullptr
#endif
  void add_members(const trace_choice *choice, std::vector<entry> &list, fb_system_state &s,
                   const std::string &from) const
  {
    for (int k = 0; k < tree.system.n_body; k++) {
      const std::string to = from + "body_" + std::to_string(k) + ".";
      const fb_joint &joint = tree.system.joint[k];
      const bool root = tree.is_root(k), turns = root || joint.kind == FB_JOINT_SPHERICAL;
      const int n = tree.of(k).n, rotors = tree.of(k).n_rotor;
      fb_link_state &link = s.link[k];
      if (root) {
        add(list, link.x, 3, to + "x");
        add(list, link.lost_x, 3, to + "lost_x");
      }
      if (root && tree.system.tied < 2) { /* else its frame stands */
        add(list, link.u, 3, to + "u");
        add(list, link.lost_u, 3, to + "lost_u");
      }
      if (turns) {
        add_member(list, link.quat, TRACE_LOST(link, quat), 4, to, "quat");
      } else if (tree.count(k, FB_AXIS_PRESCRIBED) == joint.n_axis) {
        add_list(list, link.x, joint.n_axis, to + "x");
      } else {
        add_member(list, link.x, link.lost_x, joint.n_axis, to, "x");
      }
      if (root || tree.count(k, FB_AXIS_FREE) > 0) {
        add_member(list, link.p, TRACE_LOST(link, p), root ? 6 : joint.n_axis, to, "p");
      }
      add_member(list, link.q, TRACE_LOST(link, q), n, to, "q");
      add_member(list, link.pi, TRACE_LOST(link, pi), n, to, "pi");
#if FB_SINGLE
      add_member(list, link.q + n, link.lost_q + n, rotors, to, "rotor_angle");
      add_member(list, link.pi + n, link.lost_pi + n, rotors, to, "rotor_momentum");
#else
      add_member(list, link.q + n, nullptr, rotors, to, "rotor_angle");
      add_member(list, link.pi + n, nullptr, rotors, to, "rotor_momentum");
#endif
    }
    for (int j = tree.system.n_body; j < tree.system.n_body + tree.system.n_loop; j++) {
      const std::string to = from + "loop_" + std::to_string(j - tree.system.n_body) + ".";
      if (tree.count(j, FB_AXIS_LOCKED) > 0 && tree.has_value(j)) {
        add_list(list, s.hold[j], tree.system.joint[j].n_axis, to + "hold");
      } else if (tree.count(j, FB_AXIS_LOCKED) > 0) {
        add_list(list, s.hold_quat[j], 4, to + "hold_quat");
      }
    }
    if (has_work(choice)) {
      add(list, &s.motor_work, 1, from + "motor_work");
    }
  }

  /* What prescribes axes of joint k. */
  void add_drive(fb_system_input &in, int k, const std::string &to)
  {
    for (int i = 0; i < tree.system.joint[k].n_axis && !tree.is_root(k); i++) {
      const std::string axis = "[" + std::to_string(i) + "]";
      if (tree.start.mode[k][i] == FB_AXIS_PRESCRIBED) {
        add(input, &in.drive[k].rate[i], 1, to + "rate" + axis);
        if (tree.has_value(k)) {
          add(input, &in.drive[k].value[i], 1, to + "value" + axis);
        }
      }
    }
  }

  void add_input(const trace_choice *choice, fb_system_input &in, const std::string &from)
  {
    for (int k = 0; k < tree.system.n_body; k++) {
      const std::string to = from + "body_" + std::to_string(k) + ".";
      const fb_joint &joint = tree.system.joint[k];
      const fb_body &own = tree.of(k);
      for (int at = 0; at < own.n_node; at++) {
        if (!choice->table && (at == 0 || node_is_in(&choice->loads[k], at))) {
          fb_system_load *const load = &in.load[in.n_load++];
          const std::string name = at > 0 ? "_" + std::to_string(at) : "";
          load->body = k;
          load->load.node = at;
          load->load.axes = FB_AXES_BODY;
          add(input, load->load.force, 3, to + "force" + name);
          add(input, load->load.torque, 3, to + "torque" + name);
        }
      }
      for (int i = 0; i < joint.n_axis && !tree.is_root(k); i++) {
        if (tree.start.mode[k][i] == FB_AXIS_FREE) {
          add(input, &in.drive[k].torque[i], 1, to + "motor[" + std::to_string(i) + "]");
        }
      }
      add_drive(in, k, to);
      for (int j = 0; j < own.n_rotor; j++) {
        add(input, own.rotor[j].given ? &in.rotor[k][j].momentum : &in.rotor[k][j].torque, 1,
            to + "rotor_motor[" + std::to_string(j) + "]");
      }
    }
    for (int j = 0; j < tree.system.n_loop; j++) {
      add_drive(in, tree.system.n_body + j, from + "loop_" + std::to_string(j) + ".");
    }
    for (int j = 0; j < tree.system.n_spring; j++) {
      if (choice->pulls[j]) {
        add(input, &in.pull[j], 1, from + "pull_" + std::to_string(j));
      }
    }
    of = choice;
  }

  const trace_choice *of = nullptr;

  fb_status eval(int, std::vector<entry> &results) override
  {
    const fb_body *const body = &tree.body[0];
    std::memset(work.get(), 0, sizeof *work); /* no numbers of another recording */
    next = now;
    switch (is) {
    case STEP:
      FBI_TRY(of->implicit
                  ? fb_system_sdirk_step(&tree.system, body, &next, work.get(), &acts[0], &acts[2], dt, TURNS)
                  : fb_system_rk4_step(&tree.system, body, &next, work.get(), &acts[0], &acts[1], &acts[2], dt));
      add_members(of, results, next, "state->");
      break;
    case MOTION:
      FBI_TRY(fb_system_motion_eval(&tree.system, body, work.get(), &motion, &now, &acts[0]));
      for (int k = 0; k < tree.system.n_body; k++) {
        const std::string to = "motion->body_" + std::to_string(k) + ".";
        const fb_joint &joint = tree.system.joint[k];
        fb_quat_to_mat33(R[k], motion.pose[k].quat);
        add(results, motion.pose[k].rho, 3, to + "position");
        add(results, R[k], 9, to + "R");
        add(results, motion.motion[k].v, 3, to + "v");
        add(results, motion.motion[k].w, 3, to + "w");
        add_list(results, motion.joint[k].speed, tree.is_root(k) || joint.kind == FB_JOINT_SPHERICAL ? 0 : joint.n_axis,
                 to + "speed");
        add_list(results, motion.motion[k].q_dot, tree.of(k).n, to + "q_dot");
        add_list(results, motion.motion[k].rotor_speed, tree.of(k).n_rotor, to + "rotor_speed");
      }
      break;
    case ENERGY:
      FBI_TRY(fb_system_energy_eval(&tree.system, body, work.get(), &energy, &now, &acts[0]));
      add(results, &energy.kinetic, 1, "energy->kinetic");
      add(results, &energy.strain, 1, "energy->strain");
      add(results, &energy.gravity, 1, "energy->gravity");
      break;
    case NODE:
      fbi_quat_from_mat33(pose.quat, R[0]);
      fbi_copy(pose.q, now.link[part].q, tree.of(part).n);
      FBI_TRY(fb_body_node_motion_eval(&tree.of(part), &place, &pose, &moves, node));
      add(results, place.position, 3, "out->position");
      add(results, place.quat, 4, "out->quat");
      add(results, place.velocity, 3, "out->velocity");
      add(results, place.angular_rate, 3, "out->angular_rate");
      break;
    }
    return FB_OK;
  }

  /* Prescribed values that go with their rates, from where the state has them. */
  void steer()
  {
    for (int k = 0; k < tree.system.n_body + tree.system.n_loop; k++) {
      for (int i = 0; i < 3 && tree.has_value(k); i++) {
        const number rate = acts[0].drive[k].rate[i], from = k < tree.system.n_body ? now.link[k].x[i] : given[k][i];
        for (int at = 0; at < 3 && tree.start.mode[k][i] == FB_AXIS_PRESCRIBED; at++) {
          acts[at].drive[k].rate[i] = rate;
          acts[at].drive[k].value[i] = given[k][i] = from + 0.5 * at * dt * rate;
        }
      }
    }
  }

  /* The library's own steps under random loads, from the start: loops stay closed. */
  fb_status move(double size)
  {
    fb_system_limit limit;
    now = tree.start;
    std::memset(given, 0, sizeof given);
    for (int k = 0; k < 12; k++) {
      for (const entry &e : input) {
        *e.at = e.name.compare(0, 7, "state->") == 0 ? *e.at : number(size * random());
      }
      FBI_TRY(fb_system_limit_eval(&tree.system, &tree.body[0], work.get(), &limit, &now, &acts[0]));
      dt = std::fmin(0.5 * (double)limit.rk4, 0.05);
      steer();
      FBI_TRY(fb_system_rk4_step(&tree.system, &tree.body[0], &now, work.get(), &acts[0], &acts[1], &acts[2], dt));
    }
    return FB_OK;
  }

  fb_status wander(double size) override
  {
    fb_system_limit limit;
    for (std::size_t i = 0; i < model.size(); i++) {
      const number other = described[i] * (1.0 + (tree.system.n_loop > 0 ? 1e-6 : 1e-3) * random()); /* loops close */
      for (number *at : model[i]) {
        *at = other;
      }
    }
    for (const entry &e : input) {
      *e.at = 0.1 * size * random();
    }
    FBI_TRY(tree.system.n_loop > 0 && is != NODE /* which sees no loop */
                ? move(size)
                : wander_links(*this, tree.system, &tree.body[0], now, tree.start, size));
    if (is == NODE) {
      fb_real quat[4] = {1.0, 0.3 * random(), 0.3 * random(), 0.3 * random()};
      FBI_TRY(fb_quat_normalize(quat));
      fb_quat_to_mat33(R[0], quat);
      return FB_OK;
    }
    for (const entry &e : input) {
      *e.at = e.name.find("lost_") != std::string::npos ? number(1e-17 * random()) : *e.at;
    }
    for (int k = 0; k < tree.system.n_body; k++) {
      for (int j = 0; j < tree.of(k).n_rotor; j++) {
        number &own = now.link[k].pi[tree.of(k).n + j];
        own = tree.of(k).rotor[j].given ? acts[0].rotor[k][j].momentum : own;
        for (int i = 1; i < 3; i++) {
          acts[i].rotor[k][j].momentum = acts[0].rotor[k][j].momentum;
        }
      }
    }
    if (is == STEP) {
      FBI_TRY(fb_system_limit_eval(&tree.system, &tree.body[0], work.get(), &limit, &now, &acts[0]));
      dt = (0.05 + 0.45 * std::fabs(random())) * std::fmin((double)limit.rk4, 0.1);
      if (of->implicit) { /* short ones, too: long ones need not converge */
        dt = 0.5 * std::pow(1e-3, std::fabs(random())) * std::fmin((double)limit.sdirk, 0.1);
      }
      steer();
    }
    return FB_OK;
  }
};

/* What of bodies on joints is not traced; "": all is. */
static std::string tree_refusal(const trace_choice *choice, const tree_model &tree)
{
  int moving = 0, given = 0;
  for (int k = 0; k < tree.system.n_body; k++) {
    moving += tree.is_root(k) + tree.count(k, FB_AXIS_FREE) + tree.of(k).n;
    given += tree.count(k, FB_AXIS_LOCKED) + tree.count(k, FB_AXIS_PRESCRIBED);
  }
  if (moving == 0) {
    return std::string("nothing can move") + (given > 0 ? " by itself" : "") +
           ": choose a joint with a free axis, or modes";
  }
  for (int k = 0; k < tree.system.n_body; k++) {
    if (tree.is_root(k) && tree.start.mode[k][0] != FB_AXIS_FREE) {
      return std::string(choice->body[k]) +
             ": a free joint that is locked or prescribed: choose mode free, or hang its body on the ground";
    }
    if (choice->single && tree.of(k).effects & FB_EFFECT_CENTRAL_GRAVITY) { /* the library has none */
      return "central_gravity of bodies on joints in single precision: leave out --single";
    }
  }
  return "";
}

/* The functions of bodies on joints, whose declarations stand above; 0, or 1 with why in text. */
static int write_tree_functions(FILE *out, const trace_choice *choice, const trace_model *model, char text[400])
{
  tree_model tree(model);
  file_of_functions file(out, choice);
  file.w.turns = std::string(choice->name) + "_ITERATIONS";
  file.w.judged = "fbi_newton_check";
  const std::string none = no_input, null = refused_null, in = one_input;
  const struct {
    tree_function::kind is;
    std::string head, before;
  } functions[] = {
      {tree_function::STEP, std::string("@_status @_step") + (choice->implicit ? sdirk_arguments : step_arguments),
       none + (choice->implicit ? sdirk_inputs : "  if (!state" + null + step_inputs)},
      {tree_function::MOTION, "@_status @_motion_eval(@_motion *motion, const @_state *state, const @_input *in)",
       none + "  if (!motion || !state" + null + in + refused_state},
      {tree_function::ENERGY, "@_status @_energy_eval(@_energy *energy, const @_state *state, const @_input *in)",
       none + "  if (!energy || !state" + null + in + refused_state}};
  if (!tree_refusal(choice, tree).empty()) {
    return fail(text, tree_refusal(choice, tree));
  }
  for (const auto &f : functions) {
    std::unique_ptr<tree_function> s(new tree_function(choice, tree, f.is, 0, 0));
    const std::string why = !choice->wide                 ? file.add(*s, f.head, f.before, "")
                            : f.is == tree_function::STEP ? file.add_wide(*s)
                                                          : file.add_beside(*s, f.head);
    if (!why.empty()) {
      return fail(text, why);
    }
  }
  if (choice->wide) {
    const std::string why = file.write();
    return why.empty() ? 0 : fail(text, why);
  }
  std::string cases;
  for (int k = 0; k < tree.system.n_body; k++) {
    for (int at = 0; at < tree.of(k).n_node; at++) {
      std::unique_ptr<tree_function> s(new tree_function(choice, tree, tree_function::NODE, k, at));
      const std::string name = "@_node_" + std::to_string(k) + "_" + std::to_string(at);
      const std::string why =
          file.add(*s, "static @_status " + name + "(@_node *out, const @_state *state, const @_motion *motion)", "",
                   "  (void)state;\n");
      if (!why.empty()) {
        return fail(text, why);
      }
      cases += "  case " + std::to_string(k * FB_MAX_NODES + at) + ":\n    return " + name + "(out, state, motion);\n";
    }
  }
  const std::string unwritten = file.write();
  if (!unwritten.empty()) {
    return fail(text, unwritten);
  }
  const std::string most = std::to_string(FB_MAX_NODES);
  std::fputs(
      filled(choice,
             "@_status @_node_eval(@_node *out, const @_state *state, const @_motion *motion, int body, int node)\n"
             "{\n  if (!out || !state || !motion" +
                 null + refused_state + "  if (body < 0 || body >= " + std::to_string(tree.system.n_body) +
                 " || node < 0 || node >= " + most + ") {\n    return @_value;\n  }\n  switch (body * " + most +
                 " + node) {\n" + cases + "  default:\n    return @_value;\n  }\n}\n")
          .c_str(),
      out);
  return 0;
}

} // namespace trace
#endif
