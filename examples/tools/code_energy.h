/* code_energy.h - the energy of a tree at a state, in the words of code_tree.h, by the motion of its bodies (code_motion.h):
   that of fb_system_energy_eval. Part of code_tree.h. */
#ifndef CODE_ENERGY_H
#define CODE_ENERGY_H

static struct energy_sums {
  code_sum kinetic, strain, gravity;
} energy_sums;

/* Momenta P of a body by V, and with lines by the rates of its coordinates, too. */
static void energy_write_momentum(const code *w, code_value P[6], const code_value V[6], int k)
{
  const tree_link *const L = &tree.link[k];
  code_value more[6];
  code_sum s;
  for (int i = 0; i < 6 && large_is(L->model); i++) {
    code_begin(&s);
    for (int a = 0; a < L->n; a++) {
      code_add(&s, 1.0, L->rates.lambda[i][a], code_plain("m->body_%d.q_dot[%d]", k, a));
    }
    more[i] = code_end(w, &s, code_variable("b%d_kL_%s", k, code_rows[i]));
  }
  tree_write_momentum(w, P, large_is(L->model) ? tree_nodes[k].M_rr : L->rates.S, V, large_is(L->model) ? more : NULL,
                      "kP", k);
}

/* Kinetic energy of a body, (V.S V + e.M^-1 e)/2 with e = Lambda^T V + M q_dot, with lines (V.P + e.q_dot)/2, and of its
   rotors, h^2/2J (E8.43). */
static void energy_write_kinetic(const code *w, int k)
{
  static double M[FB_MAX_MODES][FB_MAX_MODES];
  const tree_link *const L = &tree.link[k];
  code_value V[6], P[6], e[FB_MAX_MODES], y[FB_MAX_MODES];
  code own;
  code_sum s;
  for (int i = 0; i < 6; i++) {
    V[i] = code_plain("m->body_%d.%s[%d]", k, i < 3 ? "v" : "w", i % 3);
  }
  energy_write_momentum(w, P, V, k);
  own = tree_enter(w, k);
  code_read_sparse(M, &L->model->M, L->n);
  for (int a = 0; a < L->n; a++) {
    code_begin(&s);
    for (int i = 0; i < 6; i++) {
      code_add(&s, 1.0, code_now.lambda[i][a], V[i]);
    }
    for (int b = 0; b < L->n; b++) {
      code_add(&s, 1.0, code_model.large ? large_mass[k][a][b] : code_constant(M[a][b]),
               code_plain("m->body_%d.q_dot[%d]", k, b));
    }
    e[a] = code_end(&own, &s, code_variable("ke_%d", a));
    y[a] = code_plain("m->body_%d.q_dot[%d]", k, a);
  }
  if (!code_model.large) {
    code_write_solve(&own, y, e, "ky");
  }
  tree_leave(k);
  for (int i = 0; i < 6; i++) {
    code_add(&energy_sums.kinetic, 0.5, V[i], P[i]);
  }
  for (int a = 0; a < L->n; a++) {
    code_add(&energy_sums.kinetic, 0.5, e[a], y[a]);
  }
  for (int r = 0; r < L->model->n_rotor; r++) {
    const code_value h = tree_rotors[k].momentum[r];
    code_add(&energy_sums.kinetic, 0.5 / (double)L->model->rotor[r].inertia, h, h);
  }
}

/* q.K q/2 of a body and -g.(m rho + R c). */
static void energy_write_potential(const code *w, int k)
{
  static double K[FB_MAX_MODES][FB_MAX_MODES];
  const tree_link *const L = &tree.link[k];
  code own;
  code_read_sparse(K, &L->model->K, L->n);
  for (int a = 0; a < L->n; a++) {
    for (int b = 0; b <= a; b++) {
      code_add(&energy_sums.strain, (a == b ? 0.5 : 1.0) * K[a][b], code_variable("b%d_q_%d", k, a),
               code_variable("b%d_q_%d", k, b));
    }
  }
  attract_write_energy(w, &energy_sums.gravity, k);
  if (!tree_has_gravity(L->model)) {
    return;
  }
  own = tree_enter(w, k);
  for (int i = 0; i < 3; i++) {
    code_write_value(&own, i);
  }
  for (int i = 0; i < 3; i++) {
    code_add_one(&energy_sums.gravity, -code_gravity(i) * (double)L->model->mass,
                 code_plain("m->body_%d.position[%d]", k, i));
    for (int j = 0; j < 3; j++) {
      code_add(&energy_sums.gravity, -code_gravity(i), code_plain("m->body_%d.R[%d]", k, 3 * i + j), code_now.value[j]);
    }
  }
  tree_leave(k);
}

/* Spring and stop of a joint's axis at x, called `of`: k (x - rest)^2/2, k depth^2/2. */
static void energy_write_axis(const code *w, const fb_joint *joint, int a, code_value x, const char *of)
{
  const code_value stretch = code_variable("%s_far", of), depth = code_variable("%s_deep", of);
  code_sum s;
  code_begin(&s);
  code_add_one(&s, 1.0, x);
  code_add_one(&s, -(double)joint->rest[a], code_constant(1.0));
  code_declare(w, &s, stretch.name);
  code_add(&energy_sums.strain, 0.5 * (double)joint->stiffness[a], stretch, stretch);
  if (joint->stop_stiffness[a] > FB_R(0.0)) {
    rows_write_depth(w, joint, a, of);
    code_add(&energy_sums.strain, 0.5 * (double)joint->stop_stiffness[a], depth, depth);
  }
}

/* Springs and stops of a joint of the tree. */
static void energy_write_joint(const code *w, int k)
{
  const tree_link *const L = &tree.link[k];
  const int ball = L->joint->kind == FB_JOINT_SPHERICAL;
  if (ball && L->joint->stiffness[0] > FB_R(0.0)) {
    fprintf(w->out, "  %s phi%d[3];\n", code_real(w), k);
    code_template(w, "  @_vector(");
    fprintf(w->out, "phi%d, x + %d);\n", k, L->x);
  }
  for (int a = 0; a < L->axes && rows_is_sprung(L->joint); a++) {
    const code_value x = code_variable("b%d_x_%d", k, a);
    energy_write_axis(w, L->joint, a, ball ? code_variable("phi%d[%d]", k, a) : x, x.name);
  }
}

/* Of one that closes a loop. */
static void energy_write_loop(const code *w, int j)
{
  const fb_joint *const joint = constraint.loop[j].joint;
  const int ball = joint->kind == FB_JOINT_SPHERICAL;
  if (!rows_is_sprung(joint)) {
    return;
  }
  rows_write_frames(w, j);
  if (ball && joint->stiffness[0] > FB_R(0.0)) {
    rows_write_ball(w, j);
  }
  for (int i = 0; i < joint->n_axis; i++) {
    const code_value x = code_variable("l%d_x_%d", j, i);
    if (!ball && !rows_is_known(joint)) {
      rows_write_coordinate(w, j, i);
    }
    energy_write_axis(w, joint, i, ball ? code_variable("l%d_x[%d]", j, i) : x, x.name);
  }
}

/* Of a spring between points, k (l - l_0)^2/2. */
static void energy_write_span(const code *w, int j)
{
  const fb_spring *const spring = &tree.system->spring[j];
  const code_value stretch = code_variable("e%d_far", j);
  code_value x[2][3], step[3], length;
  code_sum s;
  spans_write_step(w, j, x, step);
  length = spans_write_norm(w, j, step);
  code_begin(&s);
  code_add_one(&s, 1.0, length);
  code_add_one(&s, -(double)spring->length, code_constant(1.0));
  code_declare(w, &s, stretch.name);
  code_add(&energy_sums.strain, 0.5 * (double)spring->stiffness, stretch, stretch);
}

static void energy_write_at(const code *w, int unused)
{
  (void)unused;
  code_template(w, attract_any() ? "\nstatic @_status" : "\nstatic void");
  code_template(w, " @_energy_at(@_energy *energy, const @_motion *m, const $ *x, const @_state *s, const "
                   "@_input *in)\n{\n  (void)x, (void)s, (void)in;\n");
  code_begin(&energy_sums.kinetic);
  code_begin(&energy_sums.strain);
  code_begin(&energy_sums.gravity);
  tree_write_given_names(w, NULL);
  code_template(w, tree.tied || tree.tracked ? "  $ R[9];\n  @_matrix(R, x);\n  (void)R;\n" : "");
  tree_write_names(w);
  tree_write_places(w, LARGE_MOVING);
  for (int k = 0; k < tree.n; k++) {
    if (large_is(tree.link[k].model)) {
      large_write_body(w, k);
    } else {
      tree_write_body(w, k);
    }
    energy_write_kinetic(w, k);
    energy_write_potential(w, k);
    energy_write_joint(w, k);
  }
  for (int j = 0; j < constraint.n_loop; j++) {
    energy_write_loop(w, j);
  }
  for (int j = 0; j < tree.system->n_spring; j++) {
    energy_write_span(w, j);
  }
  code_assign(w, &energy_sums.kinetic, "energy->kinetic");
  code_assign(w, &energy_sums.strain, "energy->strain");
  code_assign(w, &energy_sums.gravity, "energy->gravity");
  code_template(w, attract_any() ? "  return @_ok;\n}\n" : "}\n");
}

static const char energy_eval[] =
    "\n@_status @_energy_eval(@_energy *energy, const @_state *state, const @_input *in)\n{\n"
    "  $ x[@_N], all[3];\n  @_motion motion;\n  @_energy own;\n  @_status status;\n"
    "  if (!energy) {\n    return @_null;\n  }\n"
    "  status = @_motion_eval(&motion, state, in);\n"
    "  if (status != @_ok) {\n    return status;\n  }\n"
    "  @_enter(x, state);\n";

static const char *const energy_at[2] = {"  @_energy_at(&own, &motion, x, state, in);\n",
                                         "  status = @_energy_at(&own, &motion, x, state, in);\n"
                                         "  if (status != @_ok) {\n    return status;\n  }\n"};

static const char energy_end[] = "  all[0] = own.kinetic;\n  all[1] = own.strain;\n  all[2] = own.gravity;\n"
                                 "  if (!@_is_finite(all, 3)) {\n    return @_not_finite;\n  }\n"
                                 "  *energy = own;\n  return @_ok;\n}\n";

/* 0: there is no temporary file, see errno. */
static int energy_write_functions(const code *w)
{
  const int good = code_write_pruned(w, energy_write_at, 0);
  code_template(w, energy_eval);
  code_template(w, energy_at[attract_any()]);
  code_template(w, energy_end);
  return good;
}
#endif
