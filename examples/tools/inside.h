/* inside.h - what the generator of code, the FMU and the margins of scenes take from the library's inside. Where the
   library is an object of its own, library.c hands it out; a file that has the library in it (an FMU compiled from its
   sources) has all this already. Include it after flexbeam.h. */
#ifndef INSIDE_H
#define INSIDE_H
#include <math.h>
#define INSIDE_TRAITS int n_axis, angle, slide, tilt, pitched, holds[7] /* of the library's type of that name */
#ifndef FBI_REFUSE                                                      /* of the implementation */
#define FB_SQRT(x) ((fb_real)sqrt((double)(x)))
#define FB_FABS(x) ((fb_real)fabs((double)(x)))

typedef struct fbi_joint_traits { /* library.c compares it with the library's */
  INSIDE_TRAITS;
} fbi_joint_traits;

#define fbi_sym6_row (inside_sym6_row())
#define fbi_sym6_column (inside_sym6_column())
#define fbi_S_pair (inside_S_pair())
#define fbi_traits inside_traits
#define fbi_first_free inside_first_free
#define fbi_node_moves inside_node_moves
#define fbi_pair inside_pair
#define fbi_is_unbalanced inside_is_unbalanced
#define fbi_line_factor inside_line_factor
#define fbi_rigid_matrix inside_rigid_matrix
#define fbi_base_solve inside_base_solve
#define fbi_chol_forward inside_chol_forward
#define fbi_balance inside_balance
#define fbi_hessenberg inside_hessenberg
#define fbi_crc_word inside_crc_word
#define fbi_crc_reals inside_crc_reals
#define fbi_body_crc inside_body_crc
#endif

#if !defined(FBI_REFUSE) || defined(INSIDE_HERE) /* library.c */
const int *inside_sym6_row(void), *inside_sym6_column(void);
const int (*inside_S_pair(void))[2];
#if FB_WITH_SYSTEM
const struct fbi_joint_traits *inside_traits(const fb_joint *joint);
int inside_node_moves(const fb_body *body, int node);
/* Meets every member that a step of n bodies on joints reads, n integers or numbers, in the order of check words. */
typedef void inside_meet(void *out, const int *integer, const fb_real *number, int n);
void inside_walk(inside_meet *meet, void *out, const fb_system *system, const fb_body *body, int n);
#endif
int inside_first_free(fb_base base);
int inside_pair(int a, int b);
int inside_is_unbalanced(const fb_rotor *rotor);
const fb_real *inside_line_factor(const fb_lines *all, const fb_line *line);
void inside_rigid_matrix(fb_real S[21], fb_real m, const fb_real c[3], const fb_real J[9]);
fb_status inside_base_solve(fb_real x[6], fb_base base, const fb_real S[21], const fb_real y[6]);
void inside_chol_forward(fb_real *x, const fb_real *L, const fb_real *b, int n);
void inside_balance(fb_real *A, fb_real *D, int n);
void inside_hessenberg(fb_real *A, fb_real *Q, int n);
unsigned inside_crc_word(unsigned crc, unsigned word);
unsigned inside_crc_reals(unsigned crc, const fb_real *x, int n, int single);
unsigned inside_body_crc(const fb_body *body, int single);
#endif
#endif
