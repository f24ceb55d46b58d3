/* library.c - the library of build/flexbeam, compiled once for all words, and the functions of inside.h and rom.h. */
#include "capacities.h"
#define FBI_WITH_TEXT
#define FLEXBEAM_IMPLEMENTATION
#include "../../flexbeam.h"
#define INSIDE_HERE
#include "inside.h"
#include "rom.h"
#include <stddef.h>

const int *inside_sym6_row(void)
{
  return fbi_sym6_row;
}

const int *inside_sym6_column(void)
{
  return fbi_sym6_column;
}

const int (*inside_S_pair(void))[2]
{
  return fbi_S_pair;
}

#if FB_WITH_SYSTEM
typedef struct joint_traits {
  INSIDE_TRAITS;
} joint_traits;
typedef char traits_are_those_of_the_library[sizeof(joint_traits) == sizeof(fbi_joint_traits) &&
                                                     offsetof(joint_traits, holds) == offsetof(fbi_joint_traits, holds)
                                                 ? 1
                                                 : -1];

const fbi_joint_traits *inside_traits(const fb_joint *joint)
{
  return fbi_traits(joint);
}

int inside_node_moves(const fb_body *body, int node)
{
  return fbi_node_moves(body, node);
}

typedef struct walker {
  inside_meet *meet;
  void *out;
} walker;

static void walk_member(void *to, int kind, const char *name, const void *x, int n)
{
  const walker *const w = (const walker *)to;
  (void)name;
  if (kind == FBI_TEXT_INT) {
    w->meet(w->out, (const int *)x, NULL, n);
  } else if (kind == FBI_TEXT_REAL || kind == FBI_TEXT_REALS) {
    w->meet(w->out, NULL, (const fb_real *)x, n);
  }
}

void inside_walk(inside_meet *meet, void *out, const fb_system *system, const fb_body *body, int n)
{
  walker own;
  fbi_walk w = fbi_walk_start(1, FB_SINGLE);
  own.meet = meet;
  own.out = out;
  w.text = walk_member;
  w.out = &own;
  fbi_system_walk(&w, system);
  for (int k = 0; k < n; k++) {
    fbi_body_walk(&w, &body[k]);
  }
}
#endif

int inside_first_free(fb_base base)
{
  return fbi_first_free(base);
}

int inside_pair(int a, int b)
{
  return fbi_pair(a, b);
}

int inside_is_unbalanced(const fb_rotor *rotor)
{
  return fbi_is_unbalanced(rotor);
}

const fb_real *inside_line_factor(const fb_lines *all, const fb_line *line)
{
  return fbi_line_factor(all, line);
}

void inside_rigid_matrix(fb_real S[21], fb_real m, const fb_real c[3], const fb_real J[9])
{
  fbi_rigid_matrix(S, m, c, J);
}

fb_status inside_base_solve(fb_real x[6], fb_base base, const fb_real S[21], const fb_real y[6])
{
  return fbi_base_solve(x, base, S, y);
}

void inside_chol_forward(fb_real *x, const fb_real *L, const fb_real *b, int n)
{
  fbi_chol_forward(x, L, b, n);
}

void inside_balance(fb_real *A, fb_real *D, int n)
{
  fbi_balance(A, D, n);
}

void inside_hessenberg(fb_real *A, fb_real *Q, int n)
{
  fbi_hessenberg(A, Q, n);
}

unsigned inside_crc_word(unsigned crc, unsigned word)
{
  return fbi_crc_word(crc, word);
}

unsigned inside_crc_reals(unsigned crc, const fb_real *x, int n, int single)
{
  return fbi_crc_reals(crc, x, n, single);
}

unsigned inside_body_crc(const fb_body *body, int single)
{
  return fbi_body_crc(body, single);
}
