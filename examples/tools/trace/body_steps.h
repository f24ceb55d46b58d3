/* body_steps.h - the step of a body and what is read off its state, as C of its own. The structs, the names and the functions
   are those of code_body.h, which writes the declarations; the library's own functions, traced, are what stands in them. */
#ifndef TRACE_BODY_STEPS_H
#define TRACE_BODY_STEPS_H
#include "places.h"

namespace trace
{

/* One function of what is written: its arguments are inputs, of which the library makes results. */
struct body_function : subject {
  enum kind { STEP, RATES, MOTION, ENERGY, NODE };
  fb_body body;
  scaling *const vary; /* what of the body varies; NULL: nothing */
  const kind is;
  const int node;
  fb_state now, next;
  fb_input acts[3];
  fb_motion motion;
  fb_energy energy;
  fb_node_motion place;
  fb_rk4_work work;
  number dt = 0.0;

  body_function(const trace_choice *choice, const fb_body &of, scaling *by, kind which, int at)
      : body(by ? by->body : of), vary(by), is(which), node(at)
  {
    static const char *const when[3] = {"start->", "middle->", "end->"};
    reads = is >= MOTION;
    if (vary) {
      vary->table.bind(*this, &body);
      vary->give(*this);
    }
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
      if (k == 0 ? body.base == FB_BASE_PRESCRIBED : !node_is_in(&choice->loads[0], k)) {
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
      std::memset(&work, 0, sizeof work); /* no numbers of another recording */
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
    FBI_TRY(vary ? vary->give(*this) : FB_OK);
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

/* The functions of a body, whose declarations stand above; 0, or 1 with why in text. */
static int write_body_functions(FILE *out, const trace_choice *choice, const fb_body &body, char text[400])
{
  file_of_functions file(out, choice);
  const std::string none = no_input, null = refused_null, in = one_input, state = refused_state;
  std::unique_ptr<scaling> vary(choice->vary ? new scaling(choice, body) : nullptr);
  const struct {
    body_function::kind is;
    std::string head, before;
  } functions[] = {
      {body_function::STEP, std::string("@_status @_step") + step_arguments,
       none + "  if (!state" + null + step_inputs},
      {body_function::RATES, "@_status @_rates_eval(%@_state *rate, const @_state *state, const @_input *in)",
       none + "  if (!rate || !state" + null + in + state},
      {body_function::MOTION, "@_status @_motion_eval(%@_motion *motion, const @_state *state, const @_input *in)",
       none + "  if (!motion || !state" + null + in + state},
      {body_function::ENERGY, "@_status @_energy_eval(%@_energy *energy, const @_state *state)",
       "  if (!energy || !state" + null + state}};
  if (vary) { /* of lanes, too, as it leaves numbers near which the step is traced, see add_beside */
    const std::string why = file.add_scaling(*vary);
    if (!why.empty()) {
      return fail(text, why);
    }
    file.all.back().beside = choice->wide != 0;
    if (choice->hub && body.n > 0 && !choice->wide) {
      std::string largest = filled(choice, largest_text);
      largest.replace(largest.find('~'), 1, std::to_string(body.n));
      std::fputs(largest.c_str(), out);
    }
  }
  for (const auto &f : functions) {
    std::unique_ptr<body_function> s(new body_function(choice, body, vary.get(), f.is, 0));
    const bool is = f.is != body_function::ENERGY || body.base != FB_BASE_PRESCRIBED;
    const std::string why = !is                           ? ""
                            : !choice->wide               ? file.add(*s, f.head, f.before, "")
                            : f.is == body_function::STEP ? file.add_wide(*s)
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
  for (int k = 0; k < body.n_node; k++) {
    std::unique_ptr<body_function> s(new body_function(choice, body, vary.get(), body_function::NODE, k));
    const std::string name = "@_node_" + std::to_string(k);
    const std::string why =
        file.add(*s, "static @_status " + name + "(%@_node *out, const @_state *state, const @_motion *motion)", "",
                 "  (void)motion;\n");
    if (!why.empty()) {
      return fail(text, why);
    }
    cases += "  case " + std::to_string(k) + ":\n    return " + name + "(^out, state, motion);\n";
  }
  const std::string unwritten = file.write();
  if (!unwritten.empty()) {
    return fail(text, unwritten);
  }
  std::fputs(
      filled(choice, "@_status @_node_eval(%@_node *out, const @_state *state, const @_motion *motion, int node)\n"
                     "{\n  if (!out || !state || !motion" +
                         null + state + "  switch (node) {\n" + cases + "  default:\n    return @_value;\n  }\n}\n")
          .c_str(),
      out);
  return 0;
}

} // namespace trace
#endif
