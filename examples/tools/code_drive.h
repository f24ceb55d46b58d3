/* code_drive.h - prescribed axes in the step that code_tree.h writes: the check of their values before it (fb_drive in
   flexbeam.h), and where they are after it. Part of code_tree.h. */
#ifndef CODE_DRIVE_H
#define CODE_DRIVE_H

/* Of one body also where lanes are written, which ask it lane by lane. */
static const char drive_check[] =
    "\n/* A prescribed value that jumps, from x or in the step, by more than twice what the largest rate makes of it; "
    "or one "
    "that\n"
    "   stays while its rates go the same way. from, at (NULL: not told), to: value and rate; turns: whole turns do "
    "not "
    "count. */\n"
    "static %s @_drive_change(%s from, %s to, int turns)\n{\n"
    "  const %s change = fabs~(to - from), turn = `6.283185307179586477`;\n"
    "  return turns && change < `1e6` ? fabs~(change - turn * (%s)(long)(change / turn + `0.5`)) : change;\n}\n\n"
    "static @_status @_drive_check(%s x, const %s *from, const %s *at, const %s *to, %s dt, int turns)\n{\n"
    "  const %s *const middle = at ? at : from;\n"
    "  const %s rounding = %e * fabs~(to[0]), known = %e * fabs~(x), ra = fabs~(from[1]), rb = fabs~(to[1]);\n"
    "  const %s ends = ra > rb ? ra : rb, rate = fabs~(middle[1]), fastest = rate > ends ? rate : ends;\n"
    "  const %s most = `2` * dt * fastest + `8` * (%e + (rounding > known ? rounding : known));\n"
    "  const int same = (from[1] > `0`) == (to[1] > `0`) && !(from[0] < to[0]) && !(from[0] > to[0]);\n"
    "  int far = !(@_drive_change(x, from[0], turns) <= most);\n"
    "  if (!(fabs~(from[0]) + fabs~(to[0]) + fabs~(middle[0]) + ra + rb + rate <= @_huge)) {\n    return "
    "@_not_finite;\n  "
    "}\n"
    "  if (at) {\n"
    "    far |= !(`2` * @_drive_change(from[0], at[0], turns) <= most && `2` * @_drive_change(at[0], to[0], turns) <= "
    "most);\n"
    "  } else {\n    far |= !(fabs~(to[0] - from[0]) <= most);\n  }\n"
    "  return far || (same && dt * ra > rounding && dt * rb > rounding) ? @_contradiction : @_ok;\n}\n";

/* One member of what acts, of a lane or of all there is. */
static void drive_write_pair(const code *w, const char *name, const char *of, int k, int a)
{
  const char *const lane = w->lanes ? "[lane]" : "", *const part = tree_part(k);
  fprintf(w->out, "    const %s %s[2] = {%s->%s.value[%d]%s, %s->%s.rate[%d]%s};\n", code_scalar(w), name, of, part, a,
          lane, of, part, a, lane);
}

/* The check of axis a of joint k, of a loop not from where it is. */
static void drive_write_axis(const code *w, int k, int a)
{
  const fbi_joint_traits *const is = fbi_traits(&tree.system->joint[k]);
  const char *const part = tree_part(k), *const lane = w->lanes ? "[lane]" : "";
  if (w->lanes) {
    fprintf(w->out, "  for (int lane = 0; lane < %s_LANES && status == %s_ok; lane++) {\n", w->name, w->name);
  } else {
    code_template(w, "  if (status == @_ok) {\n");
  }
  drive_write_pair(w, "from", "start", k, a);
  drive_write_pair(w, "to", "end", k, a);
  fprintf(w->out, "    const %s at[2] = {middle ? middle->%s.value[%d]%s : 0, middle ? middle->%s.rate[%d]%s : 0};\n",
          code_scalar(w), part, a, lane, part, a, lane);
  fprintf(w->out, "    status = %s_drive_check(", w->name);
  if (k < tree.n) {
    fprintf(w->out, "state->%s.x[%d]%s, ", part, a, lane);
  } else {
    fputs("from[0], ", w->out);
  }
  fprintf(w->out, "from, middle ? at : NULL, to, dt, %d);\n  }\n", (a == is->angle || a == is->tilt) && !is->pitched);
}

static const char drive_refused[] = "  {\n    const @_status given = @_drives_check(state, start, middle, end, dt);\n"
                                    "    if (given != @_ok) {\n      return given;\n    }\n  }\n";

/* The check of all axes. */
static void drive_write_functions(const code *w)
{
  if (!w->lanes) { /* lanes have it from there */
    code_template(w, drive_check);
  }
  code_template(w,
                "\nstatic @_status @_drives_check(const @_state *state, const @_input *start, const @_input *middle,\n"
                "                              const @_input *end, %s dt)\n{\n"
                "  @_status status = @_ok;\n"
                "  if (!start || !end || start == end) {\n    return @_ok;\n  }\n");
  for (int k = 0; k < tree_parts(); k++) {
    for (int a = 0; a < tree_input_size(k, TREE_VALUE); a++) {
      if (tree.system->joint[k].mode[a] == FB_AXIS_PRESCRIBED) {
        drive_write_axis(w, k, a);
      }
    }
  }
  code_template(w, tree.n_valued > 0 ? "  return status;\n}\n" : "  (void)state;\n  return status;\n}\n");
}

/* Values after the step, of the tree alone: loops follow. */
static void drive_write_take(const code *w)
{
  code_template(w, "\nstatic @_status @_drives_take(@_state *state, const @_input *end, @_status status)\n{\n"
                   "  if (status == @_ok) {\n");
  for (int k = 0; k < tree.n; k++) {
    for (int a = 0; a < tree.link[k].axes; a++) {
      if (tree_is_driven(&tree.link[k], a) && tree_is_valued(&tree.link[k])) {
        fprintf(w->out, "    state->body_%d.x[%d] = end ? end->body_%d.value[%d] : ", k, a, k, a);
        code_template(w, "%z;\n");
      }
    }
  }
  code_template(w, "  }\n  return status;\n}\n");
}
#endif
