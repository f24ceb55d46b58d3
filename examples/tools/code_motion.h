/* code_motion.h - the motion of all bodies of a tree at a state, in the words of code_tree.h: sensors of a controller
   that has the generated step alone. Part of code_tree.h, which includes it. */
#ifndef CODE_MOTION_H
#define CODE_MOTION_H

static int motion_has_speed(const tree_link *L, int k)
{
  return k != tree.root && L->joint->kind != FB_JOINT_SPHERICAL && L->axes + L->given > 0;
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
      fprintf(w->out, "    %s speed[%d]; /* of the axes of its joint */\n", code_real(w), L->axes + L->given);
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
}

static const char motion_declaration[] =
    "/* Where the bodies are and how they move at a state, with the rates of prescribed axes (NULL: zero). */\n"
    "@_status @_motion_eval(@_motion *motion, const @_state *state, const @_input *in);\n";

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
  const int flies = tree.root >= 0 && tree_flies(k) && !tree.stands;
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
  for (int i = 0; i < L->axes + L->given && motion_has_speed(L, k); i++) {
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
  for (int k = 0; k < tree.n; k++) {
    if (tree.link[k].locked) {
      fprintf(w->out, "  const %s b%d_x_0 = x[%d];\n", code_real(w), k, tree.link[k].x);
    } else if (tree.link[k].given) {
      fprintf(w->out, "  const %s b%d_x_0 = s->body_%d.x[0], b%d_v_0 = in ? in->body_%d.rate[0] : ", code_real(w), k, k,
              k, k);
      code_template(w, "%z;\n");
    }
  }
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

/* 0: there is no temporary file, see errno. */
static int motion_write_functions(const code *w)
{
  const int limited = tree.limited, good = (tree.limited = 0, code_write_pruned(w, motion_write_at, 0));
  tree.limited = limited;
  code_template(w, motion_eval);
  return good;
}
#endif
