/* code_span.h - springs, dampers and actuators between points of a tree, in the step that code_tree.h writes and whose words
   it uses: E9.26. What they add to the step limit, E11.42, is in code_limits.h. Part of code_tree.h. */
#ifndef CODE_SPAN_H
#define CODE_SPAN_H

static struct tree_span {                            /* of a spring */
  rows_end end[2];                                   /* the nodes of its points */
  code_value R[2][9];                                /* axes of their bodies to those of the body that both hang on */
  code_value point[2][3], slope[2][FB_MAX_MODES][3]; /* from O and what modes do to it, body axes */
  code_value along[3], rate;
} tree_spans[FB_MAX_SPRINGS];

/* ---- places */

/* The body that both points of spring j hang on, -1: the ground. */
static int spans_common(int j)
{
  const fb_spring *const spring = &tree.system->spring[j];
  int common = spring->body[0];
  while (!rows_hangs(spring->body[1], common)) {
    common = tree.link[common].parent;
  }
  return common;
}

/* The point of a side, what modes do to it, and its place x in the axes of the common body. */
static void spans_write_point(const code *w, int j, int side, int common, code_value x[3])
{
  struct tree_span *const span = &tree_spans[j];
  const fb_spring *const spring = &tree.system->spring[j];
  rows_end *const end = &span->end[side];
  const code_value name = code_variable("e%d_%d", j, side);
  code_value arm[3], rho[3];
  code_sum s;
  end->link = spring->body[side];
  end->moves = 0;
  rows_unit(end->N);
  tree_nothing(end->n, 3);
  if (end->link >= 0) {
    rows_write_node(w, end, end->link, spring->node[side], name);
  }
  for (int i = 0; i < 3; i++) {
    arm[i] = code_constant((double)spring->position[side][i]);
  }
  rows_write_turned(w, arm, end->N, 0, arm, NULL, code_variable("%sa", name.name));
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, end->n[i]);
    code_add_one(&s, 1.0, arm[i]);
    span->point[side][i] = code_end(w, &s, code_variable("%so%c", name.name, tree_axis[i]));
  }
  for (int a = 0; end->link >= 0 && end->moves && a < tree.link[end->link].n; a++) {
    for (int i = 0; i < 3; i++) {
      code_begin(&s);
      code_add_one(&s, 1.0, end->Ju[a][i]);
      tree_add_cross(&s, 1.0, end->Jphi[a], arm, i);
      span->slope[side][a][i] = code_end(w, &s, code_variable("%sg%d%c", name.name, a, tree_axis[i]));
    }
  }
  rows_write_chain(w, span->R[side], rho, end->link, common, code_variable("%sc", name.name));
  rows_write_turned(w, x, span->R[side], 0, span->point[side], rho, code_variable("%sx", name.name));
}

/* Velocity of the point of a side, in the axes of the common body. */
static void spans_write_velocity(const code *w, int j, int side, code_value v[3])
{
  const struct tree_span *const span = &tree_spans[j];
  const rows_end *const end = &span->end[side];
  const tree_link *const L = &tree.link[end->link < 0 ? 0 : end->link];
  const int moves = tree.tracked && spans_common(j) < 0 && end->link >= 0 && tree_flies(end->link);
  code_value frame[3];
  code_sum s;
  tree_nothing(v, 3);
  for (int i = 0; i < 3 && end->link >= 0; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, L->V[i]);
    tree_add_cross(&s, 1.0, L->V + 3, span->point[side], i);
    for (int a = 0; a < L->n && end->moves; a++) {
      code_add(&s, 1.0, span->slope[side][a][i], L->rates.q_dot[a]);
    }
    v[i] = code_end(w, &s, code_variable("e%d_%dv%c", j, side, tree_axis[i]));
  }
  for (int i = 0; i < 3; i++) {
    frame[i] = moves ? code_variable("x[%d]", tree.link[tree.root].p + TREE_PUSHED + 3 + i) : code_constant(0.0);
  }
  rows_write_turned(w, v, span->R[side], 0, v, frame, code_variable("e%d_%dV", j, side));
}

/* Places x of both points in the axes of the common body, and the step from the first to the other. */
static void spans_write_step(const code *w, int j, code_value x[2][3], code_value step[3])
{
  const int common = spans_common(j);
  code_sum s;
  spans_write_point(w, j, 0, common, x[0]);
  spans_write_point(w, j, 1, common, x[1]);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, x[1][i]);
    code_add_one(&s, -1.0, x[0][i]);
    step[i] = code_end(w, &s, code_variable("e%d_s%c", j, tree_axis[i]));
  }
}

/* Length of a step */
static code_value spans_write_norm(const code *w, int j, const code_value step[3])
{
  const code_value length = code_variable("e%d_length", j);
  code_sum s;
  code_begin(&s);
  for (int i = 0; i < 3; i++) {
    code_add(&s, 1.0, step[i], step[i]);
  }
  code_declare(w, &s, code_variable("e%d_square", j).name);
  fprintf(w->out, "  const %s %s = ", code_real(w), length.name);
  code_template(w, "sqrt~(");
  fprintf(w->out, "e%d_square);\n", j);
  return length;
}

/* Is it a spring without length and damper, whose force is that of the step? */
static int spans_is_plain(int j)
{
  const fb_spring *const spring = &tree.system->spring[j];
  return !(spring->length > FB_R(0.0)) && !(spring->damping > FB_R(0.0));
}

/* And one without an actuator? It has no direction. */
static int spans_is_bare(int j)
{
  return spans_is_plain(j) && !spans_is_pulled(j);
}

/* What the length of spring j is compared with: its points at x meet below that. */
static void spans_write_rounding(const code *w, code_value x[2][3])
{
  code_sum s;
  code_template(w, "`16` * %e * (%z");
  for (int i = 0; i < 6; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, x[i / 3][i % 3]);
    code_template(w, " + fabs~(%z + ");
    code_expression(w, &s, 40);
    fputs(")", w->out);
  }
  fputs(")", w->out);
}

/* 1 / length of spring j, refused where its points meet. An actuator alone may rest there: 0, no direction. */
static void spans_write_share(const code *w, int j, code_value x[2][3])
{
  const int plain = spans_is_plain(j);
  char of[16];
  snprintf(of, sizeof of, "e%d", j);
  tree_template(w, plain ? "  const $ #least = " : "  if (!%((#length > ", of);
  spans_write_rounding(w, x);
  tree_template(w,
                plain ? ";\n  if (!%(((#length > #least) | (fabs~(#pull) <= `0`))%)) {\n    return @_range;\n  }\n"
                        "  const $ #share = %W#length > #least%,`1` / #length%!;\n"
                      : ")%)) {\n    return @_range;\n  }\n  const $ #share = `1` / #length;\n",
                of);
}

/* Length of spring j, of `step` from its first point to the other, and its direction. */
static void spans_write_length(const code *w, int j, const code_value step[3], code_value x[2][3])
{
  code_sum s;
  spans_write_norm(w, j, step);
  spans_write_share(w, j, x);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add(&s, 1.0, step[i], code_variable("e%d_share", j));
    tree_spans[j].along[i] = code_end(w, &s, code_variable("e%d_d%c", j, tree_axis[i]));
  }
}

/* The force on its first point, axes of the common body, by the step between the points x and their velocities v. */
static void spans_write_force(const code *w, int j, code_value force[3], const code_value step[3], code_value x[2][3],
                              code_value v[2][3])
{
  const fb_spring *const spring = &tree.system->spring[j];
  struct tree_span *const span = &tree_spans[j];
  const code_value tension = code_variable("e%d_tension", j), pull = code_variable("e%d_pull", j);
  code_sum s;
  for (int i = 0; i < 3 && spans_is_bare(j); i++) {
    force[i] = step[i];
    force[i].c *= (double)spring->stiffness;
  }
  if (spans_is_bare(j)) {
    return;
  }
  if (spans_is_pulled(j)) {
    fprintf(w->out, "  const %s %s = in ? in->pull_%d : ", code_real(w), pull.name, j);
    code_template(w, "%z;\n");
  }
  spans_write_length(w, j, step, x);
  code_begin(&s);
  for (int i = 0; i < 3; i++) {
    code_add(&s, 1.0, span->along[i], v[1][i]);
    code_add(&s, -1.0, span->along[i], v[0][i]);
  }
  span->rate = code_end(w, &s, code_variable("e%d_rate", j));
  code_begin(&s);
  code_add_one(&s, (double)spring->stiffness, code_variable("e%d_length", j));
  code_add_one(&s, -(double)spring->stiffness * (double)spring->length, code_constant(1.0));
  code_add_one(&s, (double)spring->damping, span->rate);
  code_add_one(&s, spans_is_pulled(j) ? 1.0 : 0.0, pull);
  code_declare(w, &s, tension.name);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add(&s, 1.0, tension, span->along[i]);
    force[i] = code_end(w, &s, code_variable("e%d_f%c", j, tree_axis[i]));
  }
}

/* The force on a side and its modes, added to the load of the body. */
static void spans_write_push(const code *w, int j, int side, const code_value force[3])
{
  struct tree_span *const span = &tree_spans[j];
  rows_end *const end = &span->end[side];
  const code_value name = code_variable("e%d_%d", j, side);
  code_value f[3];
  code_sum s;
  if (end->link < 0) {
    return;
  }
  rows_write_turned(w, f, span->R[side], 1, force, NULL, code_variable("%sf", name.name));
  for (int i = 0; i < 3; i++) {
    f[i].c *= side ? -1.0 : 1.0;
  }
  for (int a = 0; a < tree.link[end->link].n && end->moves; a++) {
    code_begin(&s);
    for (int i = 0; i < 3; i++) {
      code_add(&s, 1.0, span->slope[side][a][i], f[i]);
    }
    end->pushed[a] = code_end(w, &s, code_variable("%sp%d", name.name, a));
  }
  for (int i = 0; i < 6; i++) {
    code_value *const F = &tree.link[end->link].F[i];
    code_begin(&s);
    code_add_one(&s, 1.0, *F);
    if (i < 3) {
      code_add_one(&s, 1.0, f[i]);
    } else {
      tree_add_cross(&s, 1.0, span->point[side], f, i - 3);
    }
    *F = code_end(w, &s, code_variable("%sF%s", name.name, code_rows[i]));
  }
}

/* E9.26 of all springs: loads on the bodies. */
static void spans_write_loads(const code *w)
{
  fputs(tree.system->n_spring > 0 ? "\n  /* E9.26: springs between points */\n" : "", w->out);
  for (int j = 0; j < tree.system->n_spring; j++) {
    code_value x[2][3], v[2][3], step[3], force[3];
    spans_write_step(w, j, x, step);
    spans_write_velocity(w, j, 0, v[0]);
    spans_write_velocity(w, j, 1, v[1]);
    spans_write_force(w, j, force, step, x, v);
    spans_write_push(w, j, 0, force);
    spans_write_push(w, j, 1, force);
  }
}

/* The power of their actuators, -pull times rate. */
static void spans_add_power(code_sum *power)
{
  for (int j = 0; j < tree.system->n_spring; j++) {
    code_add(power, spans_is_pulled(j) ? -1.0 : 0.0, code_variable("e%d_pull", j), tree_spans[j].rate);
  }
}

/* What they do to the modes of link k. */
static void spans_add_modes(code_sum *force, int k)
{
  for (int j = 0; j < 2 * tree.system->n_spring; j++) {
    const rows_end *const end = &tree_spans[j / 2].end[j % 2];
    for (int a = 0; a < tree.link[k].n && end->link == k && end->moves; a++) {
      code_add_one(&force[a], 1.0, end->pushed[a]);
    }
  }
}
#endif
