/* code_spring.h - springs, dampers, friction and stops of the joints that close loops, and the coordinates of these (E9.7):
   see code_rows.h, part of code_tree.h. */
#ifndef CODE_SPRING_H
#define CODE_SPRING_H

/* Has the joint a spring, a damper, friction or stops? */
static int rows_is_sprung(const fb_joint *joint)
{
  fb_real sum = FB_R(0.0);
  for (int i = 0; i < 3 && i < joint->n_axis; i++) {
    sum += joint->stiffness[i] + joint->damping[i] + joint->friction[i] + joint->stop_stiffness[i];
  }
  return sum > FB_R(0.0);
}

/* Is there a loop by a spherical joint with a spring? */
static int rows_has_sprung_ball(void)
{
  int has = 0;
  for (int j = 0; j < constraint.n_loop; j++) {
    const fb_joint *const joint = constraint.loop[j].joint;
    has |= joint->kind == FB_JOINT_SPHERICAL && joint->stiffness[0] > FB_R(0.0);
  }
  return has;
}

/* Is there one by a spherical joint that is locked? */
static int rows_has_locked_ball(void)
{
  int has = 0;
  for (int j = 0; j < constraint.n_loop; j++) {
    has |= rows_held(constraint.loop[j].joint) == 4;
  }
  return has;
}

static const char rows_quat[] =
    "\n/* quaternion of a rotation matrix, by its largest component */\n"
    "static void @_quat($ *q, const $ *R)\n{\n"
    "  const $ x = R[7] - R[5], y = R[2] - R[6], z = R[3] - R[1];\n"
    "  const $ yz = R[5] + R[7], xz = R[2] + R[6], xy = R[1] + R[3];\n"
    "  const $ four[16] = {`1` + R[0] + R[4] + R[8], x, y, z, x, `1` + R[0] - R[4] - R[8], xy, xz,\n"
    "                      y, xy, `1` - R[0] + R[4] - R[8], yz, z, xz, yz, `1` - R[0] - R[4] + R[8]};\n"
    "  $ s;\n"
    "  int k = 0;\n"
    "  for (int i = 1; i < 4; i++) {\n    k = four[5 * i] > four[5 * k] ? i : k;\n  }\n"
    "  s = (four[4 * k] < `0` ? `-0.5` : `0.5`) / sqrt~(four[5 * k]);\n"
    "  for (int i = 0; i < 4; i++) {\n    q[i] = s * four[4 * k + i];\n  }\n}\n";

static const char rows_vector[] = "\n/* E4.5: rotation vector of a rotation matrix */\n"
                                  "static void @_turned($ *v, const $ *R)\n{\n  $ q[4];\n"
                                  "  @_quat(q, R);\n  @_vector(v, q);\n}\n";

static int rows_are_sprung(void)
{
  int sprung = 0;
  for (int j = 0; j < constraint.n_loop; j++) {
    sprung |= rows_is_sprung(constraint.loop[j].joint);
  }
  return sprung;
}

static void rows_write_vector(const code *w)
{
  if (rows_has_sprung_ball() && w->lanes) {
    code_template(w, "\nstatic void @_turned($ *v, const $ *R)\n{\n");
    fprintf(w->out, "  for (int k = 0; k < %s_LANES; k++) {\n", w->name);
    code_template(w, "    %s own[3], from[9];\n    for (int i = 0; i < 9; i++) {\n      from[i] = R[i][k];\n    }\n");
    fprintf(w->out, "    %s_turned(own, from);\n", w->name);
    fputs("    for (int i = 0; i < 3; i++) {\n      v[i][k] = own[i];\n    }\n  }\n}\n", w->out);
  } else if (rows_has_sprung_ball()) {
    code_template(w, rows_vector);
  }
}

/* ---- coordinates */

static void rows_write_argument(const code *w, code_value x)
{
  code_sum s;
  code_begin(&s);
  code_add_one(&s, 1.0, x);
  code_settle(&s);
  code_template(w, w->lanes && s.n == 0 ? "(%z + " : "");
  code_expression(w, &s, 60);
  fputs(w->lanes && s.n == 0 ? ")" : "", w->out);
}

/* name = atan2(y, x) */
static void rows_write_angle(const code *w, const char *name, code_value y, code_value x)
{
  fprintf(w->out, "  const %s %s = ", code_real(w), name);
  tree_call(w, "atan2");
  rows_write_argument(w, y);
  fputs(", ", w->out);
  rows_write_argument(w, x);
  fputs(");\n", w->out);
}

static void rows_declare_one(const code *w, code_value x, const char *name)
{
  code_sum s;
  code_begin(&s);
  code_add_one(&s, 1.0, x);
  code_declare(w, &s, name);
}

/* E9.7: coordinate i of loop j, named. */
static void rows_write_coordinate(const code *w, int j, int i)
{
  const rows_loop *const l = &constraint.loop[j];
  const fbi_joint_traits *const is = fbi_traits(l->joint);
  const code_value name = code_variable("l%d_x_%d", j, i);
  if (i == is->angle) {
    rows_write_angle(w, name.name, l->b[0][1], l->b[0][0]);
  } else if (i == is->tilt) {
    rows_write_angle(w, name.name, l->b[1][2], l->b[2][2]);
  } else {
    rows_declare_one(w, l->step[2], name.name);
  }
}

/* The rotation vector of a spherical joint, named. */
static void rows_write_ball(const code *w, int j)
{
  const rows_loop *const l = &constraint.loop[j];
  fprintf(w->out, "  %s l%d_R[9], l%d_x[3];\n", code_real(w), j, j);
  for (int i = 0; i < 9; i++) {
    code_sum s;
    code_begin(&s);
    code_add_one(&s, 1.0, l->b[i % 3][i / 3]);
    code_assign(w, &s, code_variable("l%d_R[%d]", j, i).name);
  }
  code_template(w, "  @_turned(");
  fprintf(w->out, "l%d_x, l%d_R);\n", j, j);
}

/* name = turn, but for whole turns */
static void rows_write_wrap(const code *w, const char *name, const char *turn)
{
  fprintf(w->out, "  const %s %s = ", code_real(w), name);
  tree_call(w, "atan2");
  tree_call(w, "sin");
  fprintf(w->out, "%s), ", turn);
  tree_call(w, "cos");
  fprintf(w->out, "%s));\n", turn);
}

/* Is the angle of a joint known by its row? */
static int rows_is_known(const fb_joint *joint)
{
  return fbi_traits(joint)->pitched && fabs((double)joint->pitch) > 0.0;
}

/* E9.8 of a screw: slide - pitch angle, but for whole turns. */
static code_value rows_write_screw(const code *w, int j)
{
  const rows_loop *const l = &constraint.loop[j];
  const int angle = fbi_traits(l->joint)->angle;
  const double pitch = (double)l->joint->pitch;
  const code_value turn = code_variable("l%d_turn", j), miss = code_variable("l%d_miss", j);
  code_sum s;
  if (!rows_is_known(l->joint)) {
    rows_declare_one(w, l->step[2], miss.name);
    return miss;
  }
  rows_write_coordinate(w, j, angle);
  code_begin(&s);
  code_add_one(&s, 1.0 / pitch, l->step[2]);
  code_add_one(&s, -1.0, code_variable("l%d_x_%d", j, angle));
  code_declare(w, &s, turn.name);
  rows_write_wrap(w, code_variable("l%d_wrap", j).name, turn.name);
  code_begin(&s);
  code_add_one(&s, pitch, code_variable("l%d_wrap", j));
  code_declare(w, &s, miss.name);
  return miss;
}

/* Axes of the child of a spherical joint when it was locked, P axes: that behind each axis. */
static void rows_write_lock(const code *w, int j)
{
  rows_loop *const l = &constraint.loop[j];
  code_sum s;
  fprintf(w->out, "  %s l%d_H[9];\n", code_real(w), j);
  code_template(w, "  @_matrix(");
  fprintf(w->out, "l%d_H, x + %d);\n", j, l->hold);
  for (int i = 0; i < 3; i++) {
    for (int c = 0; c < 3; c++) {
      code_begin(&s);
      for (int k = 0; k < 3; k++) {
        code_add(&s, 1.0, code_variable("l%d_H[%d]", j, 3 * ((i + 1) % 3) + k), l->b[k][c]);
      }
      l->lock[i][c] = code_end(w, &s, code_variable("l%d_h%d%c", j, i, tree_axis[c]));
    }
  }
}

/* E9.8 of an axis that is locked or prescribed: how far it is from there, angles but for whole turns. */
static code_value rows_write_given(const code *w, const rows_row *row)
{
  const rows_loop *const l = &constraint.loop[row->loop];
  const int j = row->loop, i = row->axis;
  const code_value off = code_variable("l%d_off_%d", j, i), miss = code_variable("l%d_miss_%d", j, i);
  code_sum s;
  if (l->joint->kind == FB_JOINT_SPHERICAL) { /* of a prescribed one the speeds alone are */
    return l->joint->mode[i] == FB_AXIS_LOCKED ? l->lock[i][i] : code_constant(0.0);
  }
  if (!rows_is_known(l->joint)) {
    rows_write_coordinate(w, j, i);
  }
  code_begin(&s);
  code_add_one(&s, 1.0, code_variable("l%d_x_%d", j, i));
  code_add_one(&s, -1.0, code_variable("l%d_t_%d", j, i));
  code_declare(w, &s, off.name);
  if (row->hold < 3) {
    return off;
  }
  rows_write_wrap(w, miss.name, off.name);
  return miss;
}

/* ---- efforts */

/* The effort of springs and dampers of a joint's axis in place of value x, at speed u: E9.11. */
static void tree_add_effort(code_sum *s, const fb_joint *joint, int a, code_value x, code_value u)
{
  code_add_one(s, -(double)joint->stiffness[a], x);
  code_add_one(s, (double)joint->stiffness[a] * (double)joint->rest[a], code_constant(1.0));
  code_add_one(s, -(double)joint->damping[a], u);
}

/* A template of an axis whose coordinate is called `of`: # begins its names, of its coordinate #x and speed #u. */
static void tree_template(const code *w, const char *text, const char *of)
{
  char all[600];
  size_t n = 0;
  for (const char *c = text; *c && n < sizeof all - 24; c++) {
    if (*c == '#') {
      n += (size_t)snprintf(all + n, sizeof all - n, "%s%s", of, c[1] == 'x' ? "" : "_");
      c += c[1] == 'x';
    } else {
      all[n++] = *c;
    }
  }
  all[n] = '\0';
  code_template(w, all);
}

/* How far an axis whose coordinate is called `of` is in its stops. */
static void rows_write_depth(const code *w, const fb_joint *joint, int a, const char *of)
{
  char text[400];
  snprintf(text, sizeof text,
           "  const $ #low = #x - `%.17g`;\n  const $ #high = #x - `%.17g`;\n"
           "  const $ #deep = (%%W#low < `0`%%,#low%%!) + (%%W#high > `0`%%,#high%%!);\n",
           (double)joint->stop[a][0], (double)joint->stop[a][1]);
  tree_template(w, text, of);
}

/* s += friction (E9.28) and stops (E9.29) of an axis whose coordinate is called `of`, at `speed`. */
static void tree_add_rubbing(const code *w, code_sum *s, const fb_joint *joint, int a, code_value speed, const char *of)
{
  const double friction = (double)joint->friction[a], slow = (double)joint->friction_speed[a];
  const double stiffness = (double)joint->stop_stiffness[a], loss = (double)joint->stop_loss[a];
  char text[400];
  code_sum u;
  if (!(friction > 0.0 || stiffness > 0.0)) {
    return;
  }
  code_begin(&u);
  code_add_one(&u, 1.0, speed);
  code_declare(w, &u, code_variable("%s_u", of).name);
  if (friction > 0.0) {
    snprintf(text, sizeof text, "  const $ #rub = `%.17g` / sqrt~(#u * #u + `%.17g`);\n", friction, slow * slow);
    tree_template(w, text, of);
    code_add(s, -1.0, code_variable("%s_rub", of), code_variable("%s_u", of));
  }
  if (stiffness > 0.0) {
    rows_write_depth(w, joint, a, of);
    snprintf(text, sizeof text,
             "  const $ #in = (%%W#low < `0`%%,-#u%%!) + (%%W#high > `0`%%,#u%%!);\n"
             "  const $ #hold = `1` + `%.17g` * #in;\n  const $ #stop = %%W#hold > `0`%%,#hold%%!;\n",
             loss);
    tree_template(w, loss > 0.0 ? text : "", of);
    code_add(s, -stiffness, code_variable("%s_deep", of),
             loss > 0.0 ? code_variable("%s_stop", of) : code_constant(1.0));
  }
}

/* Direction of an effort on axis i at the joint's origin on the child, P axes. */
static void rows_axis(code_value force[3], code_value torque[3], const rows_loop *l, int i)
{
  const fbi_joint_traits *const is = fbi_traits(l->joint);
  const int ball = l->joint->kind == FB_JOINT_SPHERICAL;
  tree_nothing(force, 3);
  tree_nothing(torque, 3);
  if (i == is->slide) {
    force[2] = code_constant(1.0);
  } else if (ball || i == is->tilt) {
    memcpy(torque, l->b[ball ? i : 0], 3 * sizeof *torque);
  } else {
    torque[2] = code_constant(1.0);
  }
}

/* Speed of axis i, named; far: velocity of the joint's origin on the child, P axes. */
static code_value rows_write_speed(const code *w, int j, int i, const code_value force[3], const code_value torque[3],
                                   const code_value far[3])
{
  const rows_loop *const l = &constraint.loop[j];
  const code_value name = code_variable("l%d_s_%d", j, i);
  code_sum s, one;
  code_begin(&s);
  for (int c = 0; c < 3; c++) {
    if (!code_is_zero(&force[c])) {
      code_begin(&one);
      code_add_one(&one, 1.0, far[c]);
      code_add_one(&one, -1.0, l->end[0].v[c]);
      tree_add_cross(&one, 1.0, l->end[0].arm, l->end[0].spin, c);
      code_add(&s, 1.0, force[c], code_end(w, &one, code_variable("l%d_sv%d%c", j, i, tree_axis[c])));
    }
    if (!code_is_zero(&torque[c])) {
      code_begin(&one);
      code_add_one(&one, 1.0, l->end[1].spin[c]);
      code_add_one(&one, -1.0, l->end[0].spin[c]);
      code_add(&s, 1.0, torque[c], code_end(w, &one, code_variable("l%d_sw%d%c", j, i, tree_axis[c])));
    }
  }
  code_declare(w, &s, name.name);
  return name;
}

/* An effort on axis i of loop j on both bodies and their modes (fbi_end_push). */
static void rows_write_effort(const code *w, int j, int i, code_value effort, const code_value force[3],
                              const code_value torque[3])
{
  rows_loop *const l = &constraint.loop[j];
  for (int side = 0; side < 2; side++) {
    rows_end *const end = &l->end[side];
    const double sign = side ? 1.0 : -1.0;
    const code_value name = code_variable("l%d_%de%d", j, side, i);
    code_value f[3], t[3], load[6];
    code_sum s;
    if (end->link < 0) {
      continue;
    }
    for (int c = 0; c < 3; c++) {
      load[c] = force[c];
      code_begin(&s);
      code_add_one(&s, 1.0, torque[c]);
      tree_add_cross(&s, 1.0, end->arm, force, c);
      t[c] = code_end(w, &s, code_variable("%sm%c", name.name, tree_axis[c]));
    }
    rows_write_turned(w, f, end->D, 0, load, NULL, code_variable("%sf", name.name));
    rows_write_turned(w, t, end->D, 0, t, NULL, code_variable("%st", name.name));
    for (int a = 0; a < tree.link[end->link].n && end->moves; a++) {
      code_value along;
      code_begin(&s);
      for (int c = 0; c < 3; c++) {
        code_add(&s, 1.0, end->Ju[a][c], f[c]);
        code_add(&s, 1.0, end->Jphi[a][c], t[c]);
      }
      along = code_end(w, &s, code_variable("%sj%d", name.name, a));
      code_begin(&s);
      code_add_one(&s, 1.0, end->pushed[a]);
      code_add(&s, sign, effort, along);
      end->pushed[a] = code_end(w, &s, code_variable("%sp%d", name.name, a));
    }
    for (int c = 0; c < 6; c++) {
      code_value *const F = &tree.link[end->link].F[c];
      code_begin(&s);
      code_add_one(&s, 1.0, c < 3 ? f[c] : t[c - 3]);
      if (c >= 3) {
        tree_add_cross(&s, 1.0, end->n, f, c - 3);
      }
      load[c] = code_end(w, &s, code_variable("%sl%s", name.name, code_rows[c]));
      code_begin(&s);
      code_add_one(&s, 1.0, *F);
      code_add(&s, sign, effort, load[c]);
      *F = code_end(w, &s, code_variable("%sF%s", name.name, code_rows[c]));
    }
  }
}

/* Efforts of loop j; far: as above. */
static void rows_write_springs(const code *w, int j, const code_value far[3])
{
  const rows_loop *const l = &constraint.loop[j];
  const int ball = l->joint->kind == FB_JOINT_SPHERICAL;
  if (!rows_is_sprung(l->joint)) {
    return;
  }
  if (ball && l->joint->stiffness[0] > FB_R(0.0)) {
    rows_write_ball(w, j);
  }
  for (int i = 0; i < l->joint->n_axis; i++) {
    const code_value name = code_variable("l%d_x_%d", j, i);
    code_value force[3], torque[3], speed;
    code_sum s;
    if (l->joint->mode[i] != FB_AXIS_FREE) {
      continue;
    }
    rows_axis(force, torque, l, i);
    if (!ball && !rows_is_known(l->joint)) {
      rows_write_coordinate(w, j, i);
    }
    speed = rows_write_speed(w, j, i, force, torque, far);
    code_begin(&s);
    tree_add_effort(&s, l->joint, i, ball ? code_variable("l%d_x[%d]", j, i) : name, speed);
    tree_add_rubbing(w, &s, l->joint, i, speed, name.name);
    code_declare(w, &s, code_variable("l%d_e_%d", j, i).name);
    rows_write_effort(w, j, i, code_variable("l%d_e_%d", j, i), force, torque);
  }
}
#endif
