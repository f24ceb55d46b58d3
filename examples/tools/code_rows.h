/* code_rows.h - loops of bodies on joints, closed by constraint rows, in the step that code_tree.h writes and whose
   words it uses: the equations of fb_system_rk4_step with rows. Part of code_tree.h, which includes first this file, what
   loops are, then code_impulse.h and code_close.h.

   M u = p + A^T mu, A u + c = 0 (E9.10): with M = L D L^T of the axes and Y = L^-1 A^T the matrix of the rows is
   Q = Y^T D^-1 Y, and what it takes of modes that the rows push by themselves. Vectors of a loop are in the axes P of the
   joint on its parent, in which the translations that it holds are unit vectors. */
#ifndef CODE_ROWS_H
#define CODE_ROWS_H

enum { ROWS_MOST = 24, ROWS_SCREW = 12, ROWS_TURN }; /* rows; behind those of fbi_traits: a screw, an axis that turns */

typedef struct rows_end { /* the node that carries one side of a loop */
  int link, moves;        /* -1: the ground; 1: modes move it */
  code_value n[3], N[9];  /* from O, turn of its axes: body axes */
  code_value phi[3], scale, Ju[FB_MAX_MODES][3], turn[FB_MAX_MODES][3], Jphi[FB_MAX_MODES][3]; /* as fbi_node_eval */
  code_value D[9], arm[3];         /* P axes to those of the body; to the joint's origin on the child, P axes */
  code_value at[3], v[3], spin[3]; /* velocity of the node, body axes; in P axes, and how fast it turns */
  code_value G[6], F[6];           /* momentum and load by the impulses at the node, body axes */
  code_value pushed[FB_MAX_MODES]; /* force on the modes by springs */
} rows_end;

typedef struct rows_loop {
  const fb_joint *joint;
  int common, first, n;        /* body that both sides hang on, -1: the ground; its rows */
  rows_end end[2];             /* parent, child */
  code_value step[3], b[3][3]; /* between the origins; axes of the child: P axes */
  code_value miss;             /* of a screw: slide less pitch times angle */
  code_value lock[3][3];       /* axes of the child when a spherical joint was locked, the next one of each first */
  int hold;                    /* place in the vector of the values where it is locked */
} rows_loop;

typedef struct rows_row {
  int loop, hold, axis;                /* axis: which one is locked or prescribed, -1: none */
  code_value value, direct[CODE_ROWS]; /* what it is on the axes */
  code_value coefficient[CODE_ROWS];   /* with what the modes pass on */
  code_value Y[CODE_ROWS];
  code_value pure[2][6], eff[2][6];                     /* its wrench on each side, and less what the modes take */
  code_value force[2][3], torque[2][3];                 /* at the nodes, P axes */
  code_value e[2][FB_MAX_MODES], bent[2][FB_MAX_MODES]; /* on the modes; M^-1 of it */
  code_value by[CODE_ROWS];                             /* D^-1 Y */
  int acts;                                             /* its place among those that move anything, -1: none */
} rows_row;

/* y = E^-1 x, x on the modes of link k; tag: of the names of y. */
typedef void rows_solve(const code *w, int k, code_value *y, const code_value *x, const char *tag);

static struct rows { /* the rows of all loops */
  int n, n_loop, acting;
  int n_driven, n_valued; /* prescribed axes; those that have a value */
  rows_solve *by;         /* how modes take them; NULL: by M, in the correction of SDIRK by its matrix */
  rows_loop loop[FB_MAX_LOOPS];
  rows_row row[ROWS_MOST];
} constraint;

/* ---- what the description is */

/* Has the row a force? */
static int rows_pushes(int hold)
{
  return hold < 3 || hold == ROWS_SCREW;
}

/* Rows of a joint that closes a loop, by their holds and axes: a slide that is given is held as any translation. */
static int rows_of(rows_row *row, const fb_joint *joint)
{
  const fbi_joint_traits *const is = fbi_traits(joint);
  int n = 0;
  for (const int *hold = is->holds; *hold >= 0; hold++) {
    row[n].axis = -1;
    row[n++].hold = *hold;
  }
  if (is->pitched) {
    row[n].axis = -1;
    row[n++].hold = ROWS_SCREW;
  }
  for (int i = 0; i < joint->n_axis; i++) {
    if (joint->mode[i] != FB_AXIS_FREE) {
      row[n].axis = i;
      row[n++].hold = i == is->slide ? 2 : ROWS_TURN;
    }
  }
  return n;
}

/* What of the loops of a system is not written; NULL: nothing. */
static const char *rows_refusal(const fb_system *system)
{
  static rows_row some[8];
  int n = 0;
  for (int j = 0; j < system->n_loop; j++) {
    n += rows_of(some, &system->joint[system->n_body + j]);
  }
  return n > ROWS_MOST ? "more than 24 constraints of loops: choose fewer" : NULL;
}

/* How many numbers of the vector tell where a joint is locked. */
static int rows_held(const fb_joint *joint)
{
  int locked = 0;
  for (int i = 0; i < joint->n_axis; i++) {
    locked |= joint->mode[i] == FB_AXIS_LOCKED;
  }
  return !locked ? 0 : joint->kind == FB_JOINT_SPHERICAL ? 4 : joint->n_axis;
}

/* The rows, and where the vector, which has `size` numbers so far, has more. */
static void rows_read(const fb_system *system, int *size)
{
  memset(&constraint, 0, sizeof constraint);
  constraint.n_loop = system->n_loop;
  for (int j = 0; j < constraint.n_loop; j++) {
    rows_loop *const l = &constraint.loop[j];
    l->joint = &system->joint[system->n_body + j];
    l->end[0].link = l->joint->parent;
    l->end[1].link = l->joint->child;
    l->first = constraint.n;
    l->n = rows_of(constraint.row + l->first, l->joint);
    constraint.n += l->n;
    l->hold = *size;
    *size += rows_held(l->joint);
    for (int r = l->first; r < constraint.n; r++) {
      const int axis = constraint.row[r].axis, driven = axis >= 0 && l->joint->mode[axis] == FB_AXIS_PRESCRIBED;
      constraint.row[r].loop = j;
      constraint.n_driven += driven;
      constraint.n_valued += driven && l->joint->kind != FB_JOINT_SPHERICAL;
    }
  }
}

#endif
