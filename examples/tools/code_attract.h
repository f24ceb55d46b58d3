/* code_attract.h - gravity of a center on the bodies of a tree, each by code_central.h. What flies has the place of O of the
   root in the vector at @_WHERE; where loops tie it to the ground @_PLACE is that place. Part of code_tree.h, which includes
   it. */
#ifndef CODE_ATTRACT_H
#define CODE_ATTRACT_H

static struct code_central tree_central[FB_MAX_BODIES];

static int attract_any(void)
{
  int any = 0;
  for (int k = 0; k < tree.n; k++) {
    any |= code_is_central(tree.link[k].model);
  }
  return any;
}

/* What single precision cannot write; NULL: nothing. */
static inline const char *attract_refusal(const fb_system *system, const fb_body *body)
{
  for (int k = 0; k < system->n_body; k++) {
    if (code_is_central(&body[system->model[k]])) {
      return "central_gravity of bodies on joints in single precision: leave out --single";
    }
  }
  return NULL;
}

/* The center of the first body that has one: places are told from there. */
static double attract_center(int i)
{
  int k = 0;
  while (k < tree.n - 1 && !code_is_central(tree.link[k].model)) {
    k++;
  }
  return (double)tree.link[k].model->center[i];
}

/* Place of the mass center of the body of code.h from the center of its field, where O is `at` from there, its axes. */
static void attract_write_mass(const code *own, code_value mass[3], const code_value at[3])
{
  code_sum s;
  code_write_center_place(own);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, at[i]);
    code_add_one(&s, 1.0, code_central.c[i]);
    mass[i] = code_end(own, &s, code_center_name("m", i));
  }
}

/* E8.37 of a body whose O is `from` from the first center, its axes, added to its load. */
static void attract_write_force(const code *w, const code_value from[3], int k)
{
  tree_link *const L = &tree.link[k];
  code_value apart[3], at[3], mass[3];
  code_sum s;
  code own;
  for (int i = 0; i < 3; i++) {
    apart[i] = code_constant((double)L->model->center[i] - attract_center(i));
  }
  tree_write_view(w, apart, apart, "Uc", k, 1);
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, from[i]);
    code_add_one(&s, -1.0, apart[i]);
    at[i] = code_end(w, &s, code_variable("b%d_Uo_%c", k, tree_axis[i]));
  }
  own = tree_enter(w, k);
  code_rotor = tree_rotors[k];
  attract_write_mass(&own, mass, at);
  code_write_center_force(&own, mass, 0);
  tree_central[k] = code_central;
  tree_leave(k);
  for (int i = 0; i < 6; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, L->F[i]);
    if (i < 3) {
      code_add_one(&s, (double)L->model->mass, code_central.own[i]);
    } else {
      tree_add_cross(&s, 1.0, L->rates.value, code_central.own, i - 3);
      code_add_one(&s, 1.0, code_central.torque[i - 3]);
    }
    L->F[i] = code_end(w, &s, code_variable("b%d_FU_%s", k, code_rows[i]));
  }
}

/* O of a link from the first center, its axes, by that of its parent. */
static void attract_write_place(const code *w, code_value at[FB_MAX_BODIES][3], int k)
{
  const int place = tree.root < 0 ? 0 : tree.link[tree.root].p + (tree.tied ? 6 : TREE_PUSHED);
  const tree_link *const L = &tree.link[k];
  code_value from[3], R[9];
  code_sum s;
  for (int i = 0; i < 9; i++) {
    R[i] = code_variable("R[%d]", i);
  }
  for (int i = 0; i < 3; i++) {
    code_begin(&s);
    code_add_one(&s, 1.0, k == tree.root ? code_variable("x[%d]", place + i) : L->s[i]);
    code_add_one(&s, 1.0, L->parent >= 0 ? at[L->parent][i] : code_constant(-attract_center(i)));
    from[i] = code_end(w, &s, code_variable("b%d_Ux_%c", k, tree_axis[i]));
  }
  tree_write_turned(w, at[k], k == tree.root ? R : L->C, 1, from, "Uat", k);
}

/* What gravity does to all bodies. */
static void attract_write_bodies(const code *w)
{
  static code_value at[FB_MAX_BODIES][3];
  const int any = attract_any();
  for (int k = 0; k < tree.n; k++) {
    tree_central[k].acts = 0;
    if (any && (tree.placed || !tree_flies(k))) {
      attract_write_place(w, at, k);
    }
    if (code_is_central(tree.link[k].model)) {
      attract_write_force(w, at[k], k);
    }
  }
}

/* s += the potential of a body at its motion m. */
static void attract_write_energy(const code *w, code_sum *s, int k)
{
  const fb_body *const body = tree.link[k].model;
  code_value apart[3], R[9], mass[3];
  code own;
  code_sum t;
  if (!code_is_central(body)) {
    return;
  }
  for (int i = 0; i < 9; i++) {
    R[i] = code_plain("m->body_%d.R[%d]", k, i);
  }
  for (int i = 0; i < 3; i++) {
    code_begin(&t);
    code_add_one(&t, 1.0, code_plain("m->body_%d.position[%d]", k, i));
    code_add_one(&t, -(double)body->center[i], code_constant(1.0));
    apart[i] = code_end(w, &t, code_variable("b%d_Ux_%c", k, tree_axis[i]));
  }
  tree_write_turned(w, apart, R, 1, apart, "Uat", k);
  own = tree_enter(w, k);
  code_rotor = tree_rotors[k];
  attract_write_mass(&own, mass, apart);
  code_write_center_field(&own, mass);
  code_write_center_energy(&own, s);
  tree_leave(k);
}
#endif
