/* code_central.h - gravity of a center in the words of code.h: E8.36 and E8.37 of a body, whose J about the mass center and
   forces on the modes come from the polynomials of M_rr and c. With G = mu/d^3 the forces are the gradients of M_rr and c
   with the weights G (1 - 3 n n^T)/2 and G (1 - 3 n n^T) c/m, which join those of E8.12. The body is that of code_model and
   code_now, its rotors those of code_rotor, names those of code_of_names. Part of code.h, which includes it. */
#ifndef CODE_CENTRAL_H
#define CODE_CENTRAL_H

/* What an evaluation has written of it. */
static struct code_central {
  int acts;                           /* 0: nothing, and no weights */
  code_value n[3], share;             /* from the center of the field to that of mass, body axes; 1/distance */
  code_value Jn[3], nJn, sum;         /* J about the mass center with n; its trace */
  code_value c[3], inverse;           /* of the mass center from O; 1/mass */
  code_value g, T[3];                 /* G, 3 G n */
  code_value own[3], torque[3], rate; /* acceleration by the second degree; torque; sqrt(3 G) */
  code_value weight[3][3], first[3];  /* of the rotational part of M_rr, upper half; of c */
} code_central;

static code_value code_center_name(const char *what, int i)
{
  return code_variable("U_%s_%c", what, 'x' + i);
}

/* Its mass, and 1/mass. */
static code_value code_center_mass(const code *w, int inverse)
{
  const double mass = (double)code_model.body->mass;
  if (w->vary & CODE_HUB) {
    return code_factor_of(w, CODE_HUB, inverse ? "inverse" : "body");
  }
  return code_constant(inverse ? 1.0 / mass : mass);
}

/* A number by a template of one line, whose %s is `of`. */
static code_value code_write_of(const code *w, code_value name, const char *format, const char *of)
{
  char text[200];
  fprintf(w->out, "%*sconst %s %s = ", w->indent, "", code_real(w), name.name);
  snprintf(text, sizeof text, format, of);
  code_template(w, text);
  return name;
}

/* c/m */
static void code_write_center_place(const code *w)
{
  struct code_central *const f = &code_central;
  code_sum s;
  f->inverse = code_center_mass(w, 1);
  for (int i = 0; i < 3; i++) {
    code_write_value(w, i);
    code_begin(&s);
    code_add(&s, 1.0, f->inverse, code_now.value[i]);
    f->c[i] = code_end(w, &s, code_center_name("c", i));
  }
}

/* Element i, j of J about the mass center: M_rr + rotors - (c.c 1 - c c^T)/m */
static code_value code_write_center_inertia(const code *w, int i, int j)
{
  const int e = fb_sym6_index(3 + i, 3 + j);
  code_sum s;
  for (int m = 0; m < code_model.n_part[e]; m++) {
    code_write_value(w, code_model.part[e][m]);
  }
  code_begin(&s);
  for (int m = 0; m < code_model.n_part[e]; m++) {
    code_add_one(&s, code_model.sign[e][m], code_now.value[code_model.part[e][m]]);
  }
  for (int r = 0; r < code_model.body->n_rotor; r++) {
    code_add(&s, (double)code_model.body->rotor[r].inertia, code_rotor.axis[r][i], code_rotor.axis[r][j]);
  }
  for (int k = 0; k < 3; k++) {
    if (i == j && k != i) {
      code_add(&s, -1.0, code_central.c[k], code_now.value[k]);
    }
  }
  if (i != j) {
    code_add(&s, 1.0, code_central.c[i], code_now.value[j]);
  }
  return code_end(w, &s, code_variable("U_J_%c%c", 'x' + i, 'x' + j));
}

/* J n, n.J n and the trace of J. */
static void code_write_center_moments(const code *w)
{
  struct code_central *const f = &code_central;
  code_value J[3][3];
  code_sum s;
  for (int i = 0; i < 3; i++) {
    J[i][i] = code_write_center_inertia(w, i, i);
  }
  for (int i = 0; i < 3; i++) {
    const int j = (i + 1) % 3;
    J[i][j] = code_write_center_inertia(w, i < j ? i : j, i < j ? j : i);
    if (code_is_constant(&J[i][j]) && fabs(J[i][j].c) <= 16.0 * DBL_EPSILON * sqrt(fabs(J[i][i].c * J[j][j].c))) {
      J[i][j] = code_constant(0.0);
    }
    J[j][i] = J[i][j];
  }
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    for (int j = 0; j < 3; j++) {
      code_add(&s, 1.0, J[i][j], f->n[j]);
    }
    f->Jn[i] = code_end(w, &s, code_center_name("Jn", i));
  }
  code_begin(&s);
  for (int i = 0; i < 3; i++) {
    code_add(&s, 1.0, f->n[i], f->Jn[i]);
  }
  f->nJn = code_end(w, &s, code_variable("U_nJn"));
  code_begin(&s);
  for (int i = 0; i < 3; i++) {
    code_add_one(&s, 1.0, J[i][i]);
  }
  f->sum = code_end(w, &s, code_variable("U_sum"));
}

/* E8.36: of a body whose mass center, its c/m written, is at `mass` from the center of the field, body axes. */
static void code_write_center_field(const code *w, const code_value mass[3])
{
  struct code_central *const f = &code_central;
  const code_value square = code_variable("U_square"), least = code_variable("U_least");
  char text[300];
  code_value distance;
  code_sum s;
  fputs("\n  /* E8.36: direction from the center of gravity, inertia about the mass center */\n", w->out);
  code_begin(&s);
  for (int i = 0; i < 3; i++) {
    code_add(&s, 1.0, mass[i], mass[i]);
  }
  code_declare(w, &s, square.name);
  distance = code_write_of(w, code_variable("U_far"), "sqrt~(%s);\n", square.name);
  f->share = code_write_of(w, code_variable("U_share"), "`1` / %s;\n", distance.name);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add(&s, 1.0, f->share, mass[i]);
    f->n[i] = code_end(w, &s, code_center_name("n", i));
  }
  code_write_center_moments(w);
  code_begin(&s);
  code_add(&s, 2.0, f->inverse, f->sum);
  code_declare(w, &s, least.name);
  snprintf(text, sizeof text,
           "  if (!%%((%s < @_huge)%%)) {\n    return @_not_finite;\n  }\n  if (!%%((%s > %s)%%)) {\n    return "
           "@_range;\n  }\n",
           distance.name, square.name, least.name);
  code_template(w, text);
}

/* E8.37: what the potential does to a body at `mass`; flying: its frame falls with the mass center, else that
   acceleration, `own` less G times mass, becomes a uniform field, and own is all of it. */
static void code_write_center_force(const code *w, const code_value mass[3], int flying)
{
  struct code_central *const f = &code_central;
  code_value fall, slope, along, square;
  code_sum s;
  code_write_center_field(w, mass);
  fputs("\n  /* E8.37: acceleration of the mass center, torque about it, weights of forces on the modes */\n", w->out);
  f->acts = 1;
  code_begin(&s);
  code_add(&s, 1.0, f->share, f->share);
  square = code_end(w, &s, code_variable("U_share2"));
  code_begin(&s);
  code_add(&s, (double)code_model.body->mu, f->share, square);
  f->g = code_end(w, &s, code_variable("U_g"));
  f->rate = code_write_of(w, code_variable("U_rate"), "sqrt~(`3` * %s);\n", f->g.name);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add(&s, 3.0, f->g, f->n[i]);
    f->T[i] = code_end(w, &s, code_center_name("T", i));
  }
  code_begin(&s);
  code_add(&s, -1.5, f->g, f->share);
  fall = code_end(w, &s, code_variable("U_fall"));
  code_begin(&s);
  code_add(&s, 1.0, fall, f->inverse);
  fall = code_end(w, &s, code_variable("U_fall_m"));
  code_begin(&s);
  code_add_one(&s, 1.0, f->sum);
  code_add_one(&s, -5.0, f->nJn);
  slope = code_end(w, &s, code_variable("U_tilt"));
  code_begin(&s);
  for (int i = 0; i < 3; i++) {
    code_add(&s, 1.0, f->n[i], f->c[i]);
  }
  along = code_end(w, &s, code_variable("U_along"));
  for (int i = 0; i < 3; i++) {
    const int y = (i + 1) % 3, z = (i + 2) % 3;
    code_value second;
    code_begin(&s);
    code_add_one(&s, 2.0, f->Jn[i]);
    code_add(&s, 1.0, slope, f->n[i]);
    second = code_end(w, &s, code_center_name("second", i));
    code_begin(&s);
    code_add(&s, 1.0, fall, second);
    code_add(&s, flying ? 0.0 : -1.0, f->g, mass[i]);
    f->own[i] = code_end(w, &s, code_center_name("a", i));
    code_begin(&s);
    code_add(&s, 1.0, f->T[y], f->Jn[z]);
    code_add(&s, -1.0, f->T[z], f->Jn[y]);
    f->torque[i] = code_end(w, &s, code_center_name("t", i));
    code_begin(&s);
    code_add(&s, 1.0, f->g, f->c[i]);
    code_add(&s, -1.0, along, f->T[i]);
    code_add_one(&s, flying ? 0.0 : 1.0, f->own[i]);
    f->first[i] = code_end(w, &s, code_center_name("C", i));
    for (int j = i; j < 3; j++) {
      code_begin(&s);
      code_add_one(&s, i == j ? 0.5 : 0.0, f->g);
      code_add(&s, i == j ? -0.5 : -1.0, f->T[i], f->n[j]);
      f->weight[i][j] = code_end(w, &s, code_variable("U_W_%c%c", 'x' + i, 'x' + j));
    }
  }
}

/* s += its weight of polynomial k */
static void code_add_center_weight(code_sum *s, int k)
{
  for (int e = 0; e < 21 && code_central.acts; e++) {
    const int i = fbi_sym6_row[e] - 3, j = fbi_sym6_column[e] - 3;
    for (int m = 0; m < code_model.n_part[e] && i >= 0; m++) {
      if (code_model.part[e][m] == k) {
        code_add_one(s, code_model.scale[k] * code_model.sign[e][m], code_central.weight[i][j]);
      }
    }
  }
  if (code_central.acts && k < 3) {
    code_add_one(s, 1.0, code_central.first[k]);
  }
}

/* Forces on the modes by rotors that they turn: -J_r 3 G (a.n) J_phi^T (a x n). */
static void code_write_center_rotors(const code *w, code_sum *force)
{
  struct code_central *const f = &code_central;
  for (int r = 0; r < code_model.body->n_rotor && f->acts; r++) {
    code_value along, across[3], bent[3];
    code_sum s;
    if (!code_model.body->rotor[r].moves) {
      continue;
    }
    code_begin(&s);
    for (int i = 0; i < 3; i++) {
      code_add(&s, -(double)code_model.body->rotor[r].inertia, code_rotor.axis[r][i], f->T[i]);
    }
    along = code_end(w, &s, code_variable("r%d_Ug", r));
    code_write_rotor_cross(w, across, code_rotor.axis[r], f->n, "Un", r);
    code_write_rotor_bent(w, bent, across, "UB", r);
    for (int i = 0; i < 3; i++) {
      code_value pull;
      code_begin(&s);
      code_add(&s, 1.0, along, bent[i]);
      pull = code_end(w, &s, code_variable("r%d_Up_%c", r, 'x' + i));
      for (int a = 0; a < w->n; a++) {
        code_add(&force[a], 1.0, code_rotor.turn[r][i][a], pull);
      }
    }
  }
}

/* s += the potential of a body whose field is written, -mu m/d - mu (tr J - 3 n.J n)/(2 d^3) */
static void code_write_center_energy(const code *w, code_sum *s)
{
  const struct code_central *const f = &code_central;
  code_value square, second, whole;
  code_sum t;
  code_begin(&t);
  code_add(&t, 0.5, f->share, f->share);
  square = code_end(w, &t, code_variable("U_half"));
  code_begin(&t);
  code_add_one(&t, 1.0, f->sum);
  code_add_one(&t, -3.0, f->nJn);
  second = code_end(w, &t, code_variable("U_second"));
  code_begin(&t);
  code_add_one(&t, 1.0, code_center_mass(w, 0));
  code_add(&t, 1.0, square, second);
  whole = code_end(w, &t, code_variable("U_whole"));
  code_add(s, -(double)code_model.body->mu, f->share, whole);
}

/* ---- the step of one body, whose x has the place of O, of a free body that of the mass center (@_lead) */

/* Place of the mass center of the body from the center of the field, inertial axes and body axes. */
static void code_write_center_apart(const code *w, code_value apart[3], code_value mass[3])
{
  code_sum s;
  code_write_center_place(w);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, code_variable("x[%d]", code_place(w, 'r') + i));
    code_add_one(&s, -(double)code_model.body->center[i], code_constant(1.0));
    apart[i] = code_end(w, &s, code_center_name("apart", i));
  }
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    for (int j = 0; j < 3; j++) {
      code_add(&s, 1.0, code_variable("R[%d]", 3 * j + i), apart[j]);
    }
    code_add_one(&s, code_model.first == 0 ? 0.0 : 1.0, code_central.c[i]);
    mass[i] = code_end(w, &s, code_center_name("m", i));
  }
}

static code_value code_apart[3];

static void code_write_attraction(const code *w)
{
  code_value mass[3];
  code_write_center_apart(w, code_apart, mass);
  code_write_center_force(w, mass, code_model.first == 0);
}

/* s += torque of gravity about O of a body that does not fly, c x a and that of the gradient */
static void code_add_center_torque(code_sum *s, int i)
{
  const int y = (i + 1) % 3, z = (i + 2) % 3;
  if (code_central.acts) {
    code_add(s, 1.0, code_now.value[y], code_central.own[z]);
    code_add(s, -1.0, code_now.value[z], code_central.own[y]);
    code_add_one(s, 1.0, code_central.torque[i]);
  }
}

/* What gravity adds to the acceleration of a body that does not fly, for the step limit. */
static void code_write_center_pull(const code *w)
{
  code_sum s;
  code_begin(&s);
  for (int i = 0; i < 3; i++) {
    code_add(&s, 1.0, code_central.own[i], code_central.own[i]);
  }
  code_declare(w, &s, "U_pull2");
  code_template(w, "  *a += sqrt~(U_pull2);\n");
}

/* s += (R x)_i */
static void code_add_turned(code_sum *s, const code_value x[3], int i)
{
  for (int j = 0; j < 3; j++) {
    code_add(s, 1.0, code_variable("R[%d]", 3 * i + j), x[j]);
  }
}

/* Rates of a free body by gravity: its frame falls. */
static void code_write_fall(const code *w)
{
  const struct code_central *const f = &code_central;
  const int places[3] = {4, 7, code_place(w, 'l')};
  fputs("\n  /* E8.37 */\n", w->out);
  for (int k = 0; k < 3; k++) {
    for (int i = 0; i < 3; i++) {
      const code_value target = code_variable("rate[%d]", places[k] + i);
      code_sum s;
      code_begin(&s);
      code_add_one(&s, 1.0, target);
      if (k == 0) {
        code_add_turned(&s, f->own, i);
        code_add(&s, -1.0, f->g, code_apart[i]);
      } else if (k == 1) {
        code_add_one(&s, 1.0, f->torque[i]);
      } else {
        code_add_turned(&s, f->torque, i);
      }
      code_assign(w, &s, target.name);
    }
  }
}

static const char code_lead[] = "\n/* The place of the mass center in that of O */\n"
                                "static void @_lead(%M$ *x)\n{\n%V  $ c[3], arm[3];\n"
                                "  @_center(%Ac, x + 10);\n  @_turn(arm, x, c);\n"
                                "  for (int i = 0; i < 3; i++) {\n    x[%r + i] += ";

static void code_write_lead(const code *w)
{
  char number[40];
  code_inverse_mass(number, w);
  code_template(w, code_lead);
  fprintf(w->out, "%s * arm[i];\n  }\n}\n", number);
}

/* U as a function of x. */
static void code_write_potential(const code *w, int unused)
{
  code_value apart[3], mass[3];
  code_sum s;
  (void)unused;
  code_template(w, "\n/* E8.37: potential [J] of gravity of a center */\n"
                   "static @_status @_potential(%M$ *U, const $ *x)\n{\n%V  $ R[9];\n");
  code_write_state(w);
  code_template(w, "  @_matrix(R, x);\n");
  code_write_lambda(w);
  for (int r = 0; r < w->rotors; r++) {
    code_write_rotor_axis(w, r);
  }
  code_write_inertia(w);
  code_write_center_apart(w, apart, mass);
  code_write_center_field(w, mass);
  code_begin(&s);
  code_write_center_energy(w, &s);
  code_assign(w, &s, "*U");
  code_template(w, "  return @_ok;\n}\n");
}
#endif
