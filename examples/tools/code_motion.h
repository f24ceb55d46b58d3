/* code_motion.h - the motion of all bodies of a tree and of their nodes at a state, in the words of code_tree.h: sensors of a
   controller that has the generated step alone. Part of code_tree.h, which includes it. */
#ifndef CODE_MOTION_H
#define CODE_MOTION_H

static int motion_has_speed(const tree_link *L, int k)
{
  return k != tree.root && L->joint->kind != FB_JOINT_SPHERICAL && L->axes > 0;
}

static void motion_write_types(const code *w)
{
  code_template(w, "typedef struct @_motion {\n");
  for (int k = 0; k < tree.n; k++) {
    const tree_link *const L = &tree.link[k];
    fprintf(w->out, "  struct { /* %s */\n", tree.names[k]);
    code_template(w, "    $ position[3], R[9]; /* [m] of O, inertial axes; its axes to the inertial ones, by rows */\n"
                     "    $ v[3], w[3];        /* [m/s] of O, [rad/s], its axes */\n");
    if (motion_has_speed(L, k)) {
      fprintf(w->out, "    %s speed[%d]; /* of the axes of its joint */\n", code_real(w), L->axes);
    }
    if (L->n > 0) {
      fprintf(w->out, "    %s q_dot[%d]; /* of its modes */\n", code_real(w), L->n);
    }
    if (L->model->n_rotor > 0) {
      fprintf(w->out, "    %s rotor_speed[%d]; /* [rad/s] relative to their section */\n", code_real(w),
              L->model->n_rotor);
    }
    fprintf(w->out, "  } body_%d;\n", k);
  }
  code_template(w, "} @_motion;\n\n");
  code_template(w, code_node_type);
  code_template(w, code_energy_type);
}

static const char motion_declarations[] =
    "/* Where the bodies are and how they move at a state, with the rates of prescribed axes (NULL: zero). */\n"
    "@_status @_motion_eval(@_motion *motion, const @_state *state, const @_input *in);\n"
    "/* A node of body_0, body_1, ..: 0 is its O, the others are those of its description in their order. quat may "
    "have "
    "either\n   sign. @_value: no such body or node. */\n"
    "@_status @_node_eval(@_node *out, const @_state *state, const @_motion *motion, int body, int node);\n"
    "/* Of all bodies and of the springs and stops of joints, at the same rates. */\n"
    "@_status @_energy_eval(@_energy *energy, const @_state *state, const @_input *in);\n";

static void motion_assign(const code *w, code_sum *s, int k, const char *member, int i)
{
  char target[40];
  snprintf(target, sizeof target, "m->body_%d.%s[%d]", k, member, i);
  code_assign(w, s, target);
}

/* Position, attitude (E9.2) and velocity (E9.5) of a link, those of its parent known. */
static void motion_write_link(const code *w, int k)
{
  const tree_link *const L = &tree.link[k];
  const int flies = tree.root >= 0 && tree_flies(k) && !tree.tied;
  code_sum s;
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      code_begin(&s);
      if (k == tree.root) {
        code_add_one(&s, 1.0, code_variable("R_root[%d]", 3 * i + j));
      } else if (L->parent < 0) {
        code_add_one(&s, 1.0, L->C[3 * i + j]);
      }
      for (int l = 0; l < 3 && L->parent >= 0; l++) {
        code_add(&s, 1.0, code_variable("m->body_%d.R[%d]", L->parent, 3 * i + l), L->C[3 * l + j]);
      }
      motion_assign(w, &s, k, "R", 3 * i + j);
    }
    code_begin(&s);
    if (k == tree.root) {
      code_add_one(&s, 1.0, code_variable("s->body_%d.x[%d]", k, i));
    } else if (L->parent < 0) {
      code_add_one(&s, 1.0, L->s[i]);
    } else {
      code_add_one(&s, 1.0, code_variable("m->body_%d.position[%d]", L->parent, i));
    }
    for (int l = 0; l < 3 && L->parent >= 0; l++) {
      code_add(&s, 1.0, code_variable("m->body_%d.R[%d]", L->parent, 3 * i + l), L->s[l]);
    }
    motion_assign(w, &s, k, "position", i);
  }
  for (int i = 0; i < 6; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, L->V[i]);
    for (int l = 0; l < 3 && i < 3 && flies; l++) {
      code_add(&s, 1.0, code_variable("m->body_%d.R[%d]", k, 3 * l + i),
               code_variable("s->body_%d.u[%d]", tree.root, l));
    }
    motion_assign(w, &s, k, i < 3 ? "v" : "w", i % 3);
  }
}

/* Speeds of a link's axes, modes and rotors. */
static void motion_write_speeds(const code *w, int k)
{
  tree_link *const L = &tree.link[k];
  code_sum s;
  for (int i = 0; i < L->axes && motion_has_speed(L, k); i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, L->u[i]);
    motion_assign(w, &s, k, "speed", i);
  }
  for (int a = 0; a < L->n; a++) {
    code_begin(&s);
    code_add_one(&s, 1.0, L->rates.q_dot[a]);
    motion_assign(w, &s, k, "q_dot", a);
  }
  if (L->model->n_rotor > 0) {
    const code own = tree_enter(w, k);
    code_rotor = tree_rotors[k];
    for (int a = 0; a < L->n; a++) {
      code_begin(&code_force[a]); /* of no use here */
    }
    code_write_rotor_speeds(&own, code_force, L->V, code_now.q_dot);
    for (int r = 0; r < L->model->n_rotor; r++) {
      code_begin(&s);
      code_add_one(&s, 1.0, code_rotor.speed[r]);
      motion_assign(&own, &s, k, "rotor_speed", r);
    }
    tree_leave(k);
  }
}

static void motion_write_at(const code *w, int unused)
{
  (void)unused;
  code_template(w, "\nstatic @_status @_motion_at(@_motion *m, const $ *x, const @_state *s, const @_input *in)\n{\n"
                   "  const int pushed = 1;\n  (void)s, (void)in, (void)pushed;\n");
  code_template(w, tree.root >= 0 ? "  $ R_root[9];\n  @_matrix(R_root, x);\n" : "");
  tree_write_given_names(w, NULL);
  tree_write_velocities(w);
  fputs("\n  /* E9.2, E9.5: places and velocities */\n", w->out);
  for (int k = 0; k < tree.n; k++) {
    motion_write_link(w, k);
    motion_write_speeds(w, k);
  }
  code_template(w, "  return @_ok;\n}\n");
}

static const char motion_eval[] =
    "\n@_status @_motion_eval(@_motion *motion, const @_state *state, const @_input *in)\n{\n"
    "  $ x[@_N];\n  @_motion next;\n  @_status status;\n"
    "  if (!motion || !state) {\n    return @_null;\n  }\n"
    "  if (!@_input_is_finite(in)) {\n    return @_not_finite;\n  }\n"
    "  @_enter(x, state);\n  memset(&next, 0, sizeof next);\n"
    "  status = @_motion_at(&next, x, state, in);\n"
    "  if (status != @_ok) {\n    return status;\n  }\n"
    "  if (!@_is_finite(x, @_N) || !@_is_finite((const $ *)(const void *)&next, (int)(sizeof next / sizeof(%s)))) {\n"
    "    return @_not_finite;\n  }\n"
    "  *motion = next;\n  return @_ok;\n}\n";

/* Displacement and rotation of a node that modes move; at: of all nodes of all links. */
static void motion_write_node(const code *w, int at)
{
  char of[16];
  const int k = at / FB_MAX_NODES;
  const int node = at % FB_MAX_NODES;
  code own = tree_enter(w, k);
  code_of_names = "";
  own.large = large_any(tree.system, tree.body);
  snprintf(of, sizeof of, "%d_", k);
  if (tree.link[k].model->node[node].line.line > 0) {
    code_write_line_node_of(&own, of, node);
  } else {
    code_write_node_of(&own, of, node);
  }
}

/* Tables of all nodes. */
static void motion_write_places(const code *w)
{
  char number[40];
  int n = 0;
  code_template(w, "  static const int first[@_BODIES + 1] = {0");
  for (int k = 0; k < tree.n; k++) {
    n += tree.link[k].model->n_node;
    fprintf(w->out, ", %d", n);
  }
  code_template(w, "};\n  static const $ place[][3] = {");
  for (int k = 0; k < tree.n; k++) {
    const fb_body *const body = tree.link[k].model;
    for (int i = 0; i < 3 * body->n_node; i++) {
      code_number(number, w, (double)body->node[i / 3].r[i % 3]);
      fprintf(w->out, "%s%s%s", i % 3 > 0 ? ", " : k + i > 0 ? ",\n    {" : "{", number, i % 3 == 2 ? "}" : "");
    }
  }
  fputs("};\n", w->out);
}

static const char *const motion_node_begin[2] = {
    "  $ q[4], s[3], v[3], w[3], u[3] = {`0`}, phi[3] = {`0`}, u_dot[3] = {`0`}, phi_dot[3] = {`0`}, share;\n",
    "  $ q[4], s[3], v[3], u[3] = {`0`}, turn[4] = {`1`}, u_dot[3] = {`0`}, spin[3] = {`0`};\n  int sound = 1;\n"};

static const char motion_node[] =
    "  const $ *x_O, *R, *v_O, *w_O;\n"
    "  @_node own;\n"
    "  if (!out || !state || !motion) {\n    return @_null;\n  }\n"
    "  if (body < 0 || body >= @_BODIES || node < 0 || node >= first[body + 1] - first[body]) {\n"
    "    return @_value;\n  }\n"
    "  memcpy(s, place[first[body] + node], sizeof s);\n";

static int motion_write_nodes(const code *w)
{
  const int large = large_any(tree.system, tree.body);
  int good = 1;
  for (int at = 0; at < tree.n * FB_MAX_NODES; at++) {
    if (fbi_node_moves(tree.link[at / FB_MAX_NODES].model, at % FB_MAX_NODES)) {
      good = code_write_pruned(w, motion_write_node, at) && good;
    }
  }
  code_template(w, "\n/* E8.20 */\n@_status @_node_eval(@_node *out, const @_state *state, const @_motion *motion, int "
                   "body, int node)\n{\n");
  motion_write_places(w);
  code_template(w, motion_node_begin[large]);
  code_template(w, motion_node);
  for (int k = 0; k < tree.n; k++) {
    const char *const members[4][2] = {{"x_O", "position"}, {"R", "R"}, {"v_O", "v"}, {"w_O", "w"}};
    if (k > 0) {
      fprintf(w->out, "  if (body == %d) {\n", k);
    }
    for (int i = 0; i < 4; i++) {
      fprintf(w->out, "%s  %s = motion->body_%d.%s;\n", k > 0 ? "  " : "", members[i][0], k, members[i][1]);
    }
    fputs(k > 0 ? "  }\n" : "", w->out);
  }
  for (int at = 0; at < tree.n * FB_MAX_NODES; at++) {
    const int k = at / FB_MAX_NODES, node = at % FB_MAX_NODES;
    if (fbi_node_moves(tree.link[k].model, node)) {
      fprintf(w->out, "  if (body == %d && node == %d) {\n    ", k, node);
      code_template(w, tree.link[k].model->node[node].line.line > 0 ? "sound = @_node_" : "@_node_");
      fprintf(w->out, "%d_%d(%s, state->body_%d.q, motion->body_%d.q_dot);\n  }\n", k, node,
              large ? "u, turn, u_dot, spin" : "u, phi, u_dot, phi_dot", k, k);
    }
  }
  code_template(w, "  @_quat(q, R);\n");
  code_template(w, large ? code_read_large_node : code_read_node);
  return good;
}

/* 0: there is no temporary file, see errno. */
static int motion_write_functions(const code *w)
{
  const int limited = tree.limited, good = (tree.limited = 0, code_write_pruned(w, motion_write_at, 0));
  tree.limited = limited;
  code_template(w, motion_eval);
  return motion_write_nodes(w) && good;
}
#endif
