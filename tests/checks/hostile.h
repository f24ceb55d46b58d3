/* hostile.h - a valid world of every kind of object, and every public function of flexbeam.h with what a valid call
   takes: for tests/checks/hostile.c, which spoils it by a list, and tests/fuzz/api.c, which spoils it at random. */
#ifndef HOSTILE_H
#define HOSTILE_H
#include "hostile_sizes.h"
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What a valid call takes; `kept` is how it was. */
static struct world {
  fb_real a[3], b[3], A[9], B[9], S[21], y[6], q[4], c[3], twist[6];
  fb_real matrix[16], definite[16], LU[16], chol[16], scale[4];
  int perm[4];
  fb_material material;
  fb_profile from, to;
  fb_section section;
  fb_build_desc build_desc;
  fb_body_factors factors;
  fb_beam_desc beam_desc, taper, build_beam[2];
  fb_beam beam[2];
  fb_modes_desc modes_desc, buckling_desc, component_desc, build_modes[2];
  fb_modes modes, component[2];
  fb_join_desc join_desc;
  fb_shape shape, empty, natural;
  fb_real r[3], psi[3 * FB_MAX_MODES], theta[3 * FB_MAX_MODES], chi[3 * FB_MAX_MODES * FB_MAX_MODES];
  fb_real center[3], inertia[6], pchi[3], hchi[3], Gamchi[9], spins[6];
  fb_fields fields;
  int coordinate[2];
  fb_gauge gauge;
  fb_real coordinates[FB_MAX_MODES];
  fb_body_desc body_desc, scene_desc, wheel_desc, bent_desc, spun_desc;
  fb_body body, held, bent, bent_held, spun,
      calm,  /* bent ones with lines, the last with rotors, central gravity; calm: balanced, held */
      orbit; /* the same in orbit */
  fb_form_torque form_torque;
  fb_form_desc form_desc;
  fb_form_body formed;
  fb_state state, bent_state, spun_state, calm_state, orbit_state, form_state;
  fb_input input, bent_input, spun_input, orbit_input;
  fb_motion motion, bent_motion;
  fb_node_motion node_motion;
  fb_real v[3], w[3], q_dot[FB_MAX_MODES], gravity[3];
  fb_exponential exponential, bent_exponential, spun_exponential;
  fb_system_desc system_desc;
  fb_system system, bent_system, calm_system;
  fb_link_motion link_motion[FB_MAX_BODIES];
  fb_system_state system_state, bent_system_state, calm_system_state;
  fb_system_motion bent_system_motion;
  fb_system_input system_input, calm_system_input;
  fb_exact_station exact_station;
  fb_exact_desc exact_desc;
  fb_exact exact;
  fb_exact_state exact_state;
  fb_exact_input exact_input;
  fb_linear_desc linear_desc, motor_desc, system_linear_desc;
  fb_exact_path exact_path;
  fb_linear_desc exact_linear_desc;
  fb_spectrum spectrum;
  fb_real amplitude[FB_MAX_LINEAR], re[4];
  fb_envelope envelope;
  fb_trial trial;
  fb_stepper_desc stepper_desc;
  fb_stepper stepper;
  char config[sizeof FB_CONFIG];
} w, kept;

static fb_modes_work modes_work;
static fb_join_work join_work;
static fb_body_work body_work;
static fb_build_work build_work;
static fb_rk4_work rk4_work;
static fb_implicit_work implicit_work;
static fb_form_work form_work;
static fb_exponential_work exponential_work;
static fb_system_work system_work;
static fb_exact_work exact_work;
static fb_analyse_work analyse_work;
static fb_system_analyse_work system_analyse_work;
static fb_exact_spectrum_work spectrum_work;
static fb_exact_linear_work linear_work;
static fb_exact_path_work path_work;
static fb_advice_work advise_work;
static fb_real eig_work[64], trial_output[3], trial_reference[3];

/* ---- calls: pointers p, numbers x, whole numbers i, in the order of the arguments */

static fb_real number; /* what a function that gives a number has given */

static int give(fb_real value)
{
  number = value;
  return FB_OK;
}

#define CALL(function, expression)                                     \
  static int call_##function(void **p, const fb_real *x, const int *i) \
  {                                                                    \
    (void)p;                                                           \
    (void)x;                                                           \
    (void)i;                                                           \
    return (int)(expression);                                          \
  }

/* Pointers: IN is data that anybody may have spoiled, STATE likewise and changed by the call, MODEL was made by the
   library (a check of its own looks for flipped bits: faults.sh), BUILT is such a thing that the call goes on with, OUT
   is written, WORK is scratch. OPTIONAL may be NULL. */
#define IN(field)                    \
  {                                  \
    &w.field, sizeof w.field, 'i', 0 \
  }
#define OPTIONAL(field)              \
  {                                  \
    &w.field, sizeof w.field, '?', 0 \
  }
#define STATE(field)                 \
  {                                  \
    &w.field, sizeof w.field, 's', 0 \
  }
#define MODEL(field)                 \
  {                                  \
    &w.field, sizeof w.field, 'm', 0 \
  }
#define BUILT(field)                 \
  {                                  \
    &w.field, sizeof w.field, 'b', 0 \
  }
#define BUILT_TO(field, type, work)        \
  {                                        \
    &w.field, offsetof(type, work), 'b', 0 \
  } /* the rest is scratch */
#define SPOILED(field)               \
  {                                  \
    &w.field, sizeof w.field, 'x', 0 \
  }
#define OUT(type)              \
  {                            \
    NULL, sizeof(type), 'o', 0 \
  }
#define MAYBE(type)            \
  {                            \
    NULL, sizeof(type), 'O', 0 \
  } /* an output that may be NULL */
#define WORK(object)                  \
  {                                   \
    &(object), sizeof(object), 'w', 0 \
  }
#define REAL(value)     \
  {                     \
    NULL, 0, 'r', value \
  }
#define WHOLE(value)    \
  {                     \
    NULL, 0, 'n', value \
  }
#define SIZE(value)     \
  {                     \
    NULL, 0, 'z', value \
  } /* of arrays: too large a one cannot be noticed */

#define COUNT(value)    \
  {                     \
    NULL, 0, 'c', value \
  } /* of arithmetic: is right */

typedef fb_real vec3[3], vec4[4], vec6[6], mat33[9], mat44[16], mat48[32];
typedef fb_real matrices[36 * (FB_MAX_ELEMENTS + 1) * (FB_MAX_ELEMENTS + 1)];
typedef fb_exact_node nodes[FB_MAX_EXACT + 1];
typedef fb_line_motion line_points[FB_MAX_LINE_POINTS];

/* F(function, call, has a status, arguments...) */
#define SLOW 2       /* it has: few poisons */
#define ARITHMETIC 3 /* none, and pointers are valid */
/* Again with a body with rotors, one of them on a node that moves, and central gravity; hostile.sh takes the ending
   off. */
#define OF_ROTORS(F)                                                                                                   \
  F(fb_body_init_of_rotors, fb_body_init(p[0], p[1], p[2], p[3]), SLOW, OUT(fb_body), WORK(body_work), IN(natural),    \
    IN(spun_desc))                                                                                                     \
  F(fb_body_check_of_rotors, fb_body_check(p[0]), 1, MODEL(spun))                                                      \
  F(fb_body_crc_of_rotors, give((fb_real)fb_body_crc(p[0])), 0, MODEL(spun))                                           \
  F(fb_state_from_velocity_of_rotors, fb_state_from_velocity(p[0], p[1], p[2], p[3], p[4]), 1, MODEL(spun),            \
    STATE(spun_state), IN(v), IN(w), OPTIONAL(q_dot))                                                                  \
  F(fb_state_rotor_set, fb_state_rotor_set(p[0], p[1], i[0], x[0], x[1], p[2]), 1, MODEL(spun), STATE(spun_state),     \
    WHOLE(1), REAL(FB_R(1.0)), REAL(FB_R(0.5)), OPTIONAL(spun_input))                                                  \
  F(fb_state_check_of_rotors, fb_state_check(p[0], p[1]), 1, MODEL(spun), IN(spun_state))                              \
  F(fb_body_rates_eval_of_rotors, fb_body_rates_eval(p[0], p[1], p[2], p[3]), 1, MODEL(spun), OUT(fb_state),           \
    IN(spun_state), OPTIONAL(spun_input))                                                                              \
  F(fb_body_motion_eval_of_rotors, fb_body_motion_eval(p[0], p[1], p[2], p[3]), 1, MODEL(spun), OUT(fb_motion),        \
    IN(spun_state), OPTIONAL(spun_input))                                                                              \
  F(fb_body_energy_eval_of_rotors, fb_body_energy_eval(p[0], p[1], p[2], p[3]), 1, MODEL(spun), OUT(fb_energy),        \
    IN(spun_state), OPTIONAL(spun_input))                                                                              \
  F(fb_body_momentum_eval_of_rotors, fb_body_momentum_eval(p[0], p[1], p[2], p[3]), 1, MODEL(spun), OUT(fb_momentum),  \
    IN(spun_state), OPTIONAL(spun_input))                                                                              \
  F(fb_rk4_step_of_rotors, fb_rk4_step(p[0], p[1], p[2], p[3], p[4], p[5], x[0]), 1, MODEL(spun), STATE(spun_state),   \
    WORK(rk4_work), OPTIONAL(spun_input), OPTIONAL(spun_input), OPTIONAL(spun_input), REAL(FB_R(0.01)))                \
  F(fb_midpoint_step_of_rotors, fb_midpoint_step(p[0], p[1], p[2], p[3], x[0], i[0]), 1, MODEL(spun),                  \
    STATE(spun_state), WORK(implicit_work), OPTIONAL(spun_input), REAL(FB_R(0.01)), WHOLE(2))                          \
  F(fb_sdirk_step_of_rotors, fb_sdirk_step(p[0], p[1], p[2], p[3], p[4], x[0], i[0]), 1, MODEL(spun),                  \
    STATE(spun_state), WORK(implicit_work), IN(spun_input), IN(spun_input), REAL(FB_R(0.01)), WHOLE(2))                \
  F(fb_body_limit_eval_of_rotors, fb_body_limit_eval(p[0], p[1], p[2], p[3]), 1, MODEL(spun), OUT(fb_body_limit),      \
    IN(spun_state), OPTIONAL(spun_input))                                                                              \
  F(fb_exponential_init_of_rotors, fb_exponential_init(p[0], p[1], p[2], x[0]), 1, OUT(fb_exponential),                \
    WORK(body_work), MODEL(spun), REAL(FB_R(0.01)))                                                                    \
  F(fb_exponential_step_of_rotors, fb_exponential_step(p[0], p[1], p[2], p[3], p[4], p[5], p[6]), 1, MODEL(spun),      \
    MODEL(spun_exponential), STATE(spun_state), WORK(exponential_work), OPTIONAL(spun_input), OPTIONAL(spun_input),    \
    OPTIONAL(spun_input))                                                                                              \
  F(fb_body_trim_of_rotors, fb_body_trim(p[0], p[1], p[2], p[3]), SLOW, MODEL(calm), STATE(calm_state),                \
    WORK(analyse_work), IN(spun_input))                                                                                \
  F(fb_body_linearize_of_rotors, fb_body_linearize(p[0], p[1], p[2], p[3], p[4], p[5]), SLOW, MODEL(calm),             \
    WORK(analyse_work), OUT(fb_linear), IN(calm_state), IN(spun_input), OPTIONAL(motor_desc))                          \
  F(fb_body_spectrum_solve_of_rotors, fb_body_spectrum_solve(p[0], p[1], p[2], p[3], p[4]), SLOW, MODEL(calm),         \
    WORK(analyse_work), OUT(fb_spectrum), IN(calm_state), IN(spun_input))                                              \
  F(fb_body_trim_of_orbits, fb_body_trim(p[0], p[1], p[2], p[3]), SLOW, MODEL(orbit), STATE(orbit_state),              \
    WORK(analyse_work), IN(orbit_input))                                                                               \
  F(fb_body_linearize_of_orbits, fb_body_linearize(p[0], p[1], p[2], p[3], p[4], p[5]), SLOW, MODEL(orbit),            \
    WORK(analyse_work), OUT(fb_linear), IN(orbit_state), IN(orbit_input), OPTIONAL(motor_desc))                        \
  F(fb_body_spectrum_solve_of_orbits, fb_body_spectrum_solve(p[0], p[1], p[2], p[3], p[4]), SLOW, MODEL(orbit),        \
    WORK(analyse_work), OUT(fb_spectrum), IN(orbit_state), IN(orbit_input))                                            \
  F(fb_advice_solve_of_rotors, fb_advice_solve(p[0], p[1], p[2], p[3], p[4], x[0]), SLOW, OUT(fb_advice),              \
    WORK(advise_work), MODEL(natural), IN(wheel_desc), IN(envelope), REAL(FB_R(0.1)))                                  \
  F(fb_system_check_of_rotors, fb_system_check(p[0], p[1], i[0]), 1, MODEL(calm_system), MODEL(calm), WHOLE(1))        \
  F(fb_system_state_init_of_rotors, fb_system_state_init(p[0], p[1], p[2], p[3], p[4], p[5]), 1, MODEL(calm_system),   \
    MODEL(calm), OUT(fb_system_state), WORK(system_work), OPTIONAL(link_motion), OPTIONAL(calm_system_input))          \
  F(fb_system_rates_eval_of_rotors, fb_system_rates_eval(p[0], p[1], p[2], p[3], p[4], p[5]), 1, MODEL(calm_system),   \
    MODEL(calm), WORK(system_work), OUT(fb_system_state), IN(calm_system_state), OPTIONAL(calm_system_input))          \
  F(fb_system_motion_eval_of_rotors, fb_system_motion_eval(p[0], p[1], p[2], p[3], p[4], p[5]), 1, MODEL(calm_system), \
    MODEL(calm), WORK(system_work), OUT(fb_system_motion), IN(calm_system_state), OPTIONAL(calm_system_input))         \
  F(fb_system_rk4_step_of_rotors, fb_system_rk4_step(p[0], p[1], p[2], p[3], p[4], p[5], p[6], x[0]), 1,               \
    MODEL(calm_system), MODEL(calm), STATE(calm_system_state), WORK(system_work), OPTIONAL(calm_system_input),         \
    OPTIONAL(calm_system_input), OPTIONAL(calm_system_input), REAL(FB_R(0.001)))                                       \
  F(fb_system_sdirk_step_of_rotors, fb_system_sdirk_step(p[0], p[1], p[2], p[3], p[4], p[5], x[0], i[0]), 1,           \
    MODEL(calm_system), MODEL(calm), STATE(calm_system_state), WORK(system_work), IN(calm_system_input),               \
    IN(calm_system_input), REAL(FB_R(0.001)), WHOLE(2))                                                                \
  F(fb_system_linearize_of_rotors, fb_system_linearize(p[0], p[1], p[2], p[3], p[4], p[5], p[6]), SLOW,                \
    MODEL(calm_system), MODEL(calm), WORK(system_analyse_work), OUT(fb_linear), IN(calm_system_state),                 \
    OPTIONAL(calm_system_input), OPTIONAL(motor_desc))
/* Again with a body with lines, its loads distributed by a callback. */
#define OF_LINES(F)                                                                                                   \
  F(fb_body_init_of_lines, fb_body_init(p[0], p[1], p[2], p[3]), SLOW, OUT(fb_body), WORK(body_work), IN(natural),    \
    IN(bent_desc))                                                                                                    \
  F(fb_body_check_of_lines, fb_body_check(p[0]), 1, MODEL(bent))                                                      \
  F(fb_body_crc_of_lines, give((fb_real)fb_body_crc(p[0])), 0, MODEL(bent))                                           \
  F(fb_state_from_velocity_of_lines, fb_state_from_velocity(p[0], p[1], p[2], p[3], p[4]), 1, MODEL(bent),            \
    STATE(bent_state), IN(v), IN(w), OPTIONAL(q_dot))                                                                 \
  F(fb_state_check_of_lines, fb_state_check(p[0], p[1]), 1, MODEL(bent), IN(bent_state))                              \
  F(fb_body_rates_eval_of_lines, fb_body_rates_eval(p[0], p[1], p[2], p[3]), 1, MODEL(bent), OUT(fb_state),           \
    IN(bent_state), OPTIONAL(bent_input))                                                                             \
  F(fb_body_motion_eval_of_lines, fb_body_motion_eval(p[0], p[1], p[2], p[3]), 1, MODEL(bent), OUT(fb_motion),        \
    IN(bent_state), OPTIONAL(bent_input))                                                                             \
  F(fb_body_node_motion_eval_of_lines, fb_body_node_motion_eval(p[0], p[1], p[2], p[3], i[0]), 1, MODEL(bent),        \
    OUT(fb_node_motion), IN(bent_state), IN(bent_motion), WHOLE(1))                                                   \
  F(fb_body_energy_eval_of_lines, fb_body_energy_eval(p[0], p[1], p[2], p[3]), 1, MODEL(bent), OUT(fb_energy),        \
    IN(bent_state), OPTIONAL(bent_input))                                                                             \
  F(fb_body_momentum_eval_of_lines, fb_body_momentum_eval(p[0], p[1], p[2], p[3]), 1, MODEL(bent), OUT(fb_momentum),  \
    IN(bent_state), OPTIONAL(bent_input))                                                                             \
  F(fb_rk4_step_of_lines, fb_rk4_step(p[0], p[1], p[2], p[3], p[4], p[5], x[0]), 1, MODEL(bent), STATE(bent_state),   \
    WORK(rk4_work), OPTIONAL(bent_input), OPTIONAL(bent_input), OPTIONAL(bent_input), REAL(FB_R(0.01)))               \
  F(fb_midpoint_step_of_lines, fb_midpoint_step(p[0], p[1], p[2], p[3], x[0], i[0]), 1, MODEL(bent),                  \
    STATE(bent_state), WORK(implicit_work), OPTIONAL(bent_input), REAL(FB_R(0.01)), WHOLE(2))                         \
  F(fb_sdirk_step_of_lines, fb_sdirk_step(p[0], p[1], p[2], p[3], p[4], x[0], i[0]), 1, MODEL(bent),                  \
    STATE(bent_state), WORK(implicit_work), IN(bent_input), IN(bent_input), REAL(FB_R(0.01)), WHOLE(2))               \
  F(fb_body_limit_eval_of_lines, fb_body_limit_eval(p[0], p[1], p[2], p[3]), 1, MODEL(bent), OUT(fb_body_limit),      \
    IN(bent_state), OPTIONAL(bent_input))                                                                             \
  F(fb_exponential_init_of_lines, fb_exponential_init(p[0], p[1], p[2], x[0]), 1, OUT(fb_exponential),                \
    WORK(body_work), MODEL(bent), REAL(FB_R(0.01)))                                                                   \
  F(fb_exponential_step_of_lines, fb_exponential_step(p[0], p[1], p[2], p[3], p[4], p[5], p[6]), 1, MODEL(bent),      \
    MODEL(bent_exponential), STATE(bent_state), WORK(exponential_work), OPTIONAL(bent_input), OPTIONAL(bent_input),   \
    OPTIONAL(bent_input))                                                                                             \
  F(fb_body_trim_of_lines, fb_body_trim(p[0], p[1], p[2], p[3]), SLOW, MODEL(bent_held), STATE(bent_state),           \
    WORK(analyse_work), IN(bent_input))                                                                               \
  F(fb_body_linearize_of_lines, fb_body_linearize(p[0], p[1], p[2], p[3], p[4], p[5]), SLOW, MODEL(bent_held),        \
    WORK(analyse_work), OUT(fb_linear), IN(bent_state), IN(bent_input), OPTIONAL(linear_desc))                        \
  F(fb_body_spectrum_solve_of_lines, fb_body_spectrum_solve(p[0], p[1], p[2], p[3], p[4]), SLOW, MODEL(bent_held),    \
    WORK(analyse_work), OUT(fb_spectrum), IN(bent_state), IN(bent_input))                                             \
  F(fb_system_rates_eval_of_lines, fb_system_rates_eval(p[0], p[1], p[2], p[3], p[4], p[5]), 1, MODEL(bent_system),   \
    MODEL(bent), WORK(system_work), OUT(fb_system_state), IN(bent_system_state), OPTIONAL(system_input))              \
  F(fb_system_motion_eval_of_lines, fb_system_motion_eval(p[0], p[1], p[2], p[3], p[4], p[5]), 1, MODEL(bent_system), \
    MODEL(bent), WORK(system_work), OUT(fb_system_motion), IN(bent_system_state), OPTIONAL(system_input))             \
  F(fb_system_rk4_step_of_lines, fb_system_rk4_step(p[0], p[1], p[2], p[3], p[4], p[5], p[6], x[0]), 1,               \
    MODEL(bent_system), MODEL(bent), STATE(bent_system_state), WORK(system_work), OPTIONAL(system_input),             \
    OPTIONAL(system_input), OPTIONAL(system_input), REAL(FB_R(0.001)))                                                \
  F(fb_system_sdirk_step_of_lines, fb_system_sdirk_step(p[0], p[1], p[2], p[3], p[4], p[5], x[0], i[0]), 1,           \
    MODEL(bent_system), MODEL(bent), STATE(bent_system_state), WORK(system_work), IN(system_input), IN(system_input), \
    REAL(FB_R(0.001)), WHOLE(2))

#define FUNCTIONS(F)                                                                                                   \
  F(fb_status_string, fb_status_string((fb_status)i[0]) ? 0 : -1, 0, WHOLE(0))                                         \
  F(fb_detail_last, fb_detail_last() ? 0 : -1, 0, REAL(0))                                                             \
  F(fb_vec3_dot, give(fb_vec3_dot(p[0], p[1])), ARITHMETIC, IN(a), IN(b))                                              \
  F(fb_vec3_cross, (fb_vec3_cross(p[0], p[1], p[2]), 0), ARITHMETIC, OUT(vec3), IN(a), IN(b))                          \
  F(fb_mat33_mul_vec3, (fb_mat33_mul_vec3(p[0], p[1], p[2]), 0), ARITHMETIC, OUT(vec3), IN(A), IN(a))                  \
  F(fb_mat33_mulT_vec3, (fb_mat33_mulT_vec3(p[0], p[1], p[2]), 0), ARITHMETIC, OUT(vec3), IN(A), IN(a))                \
  F(fb_mat33_mul, (fb_mat33_mul(p[0], p[1], p[2]), 0), ARITHMETIC, OUT(mat33), IN(A), IN(B))                           \
  F(fb_sym6_index, give((fb_real)fb_sym6_index(i[0], i[1])), 0, WHOLE(2), WHOLE(1))                                    \
  F(fb_sym6_mul_vec6, (fb_sym6_mul_vec6(p[0], p[1], p[2]), 0), ARITHMETIC, OUT(vec6), IN(S), IN(y))                    \
  F(fb_sym6_solve, fb_sym6_solve(p[0], p[1], p[2]), 1, OUT(vec6), IN(S), IN(y))                                        \
  F(fb_quat_mul, (fb_quat_mul(p[0], p[1], p[2]), 0), ARITHMETIC, OUT(vec4), IN(q), IN(q))                              \
  F(fb_quat_to_mat33, (fb_quat_to_mat33(p[0], p[1]), 0), ARITHMETIC, OUT(mat33), IN(q))                                \
  F(fb_quat_from_rotvec, (fb_quat_from_rotvec(p[0], p[1]), 0), ARITHMETIC, OUT(vec4), IN(a))                           \
  F(fb_quat_to_rotvec, (fb_quat_to_rotvec(p[0], p[1]), 0), ARITHMETIC, OUT(vec3), IN(q))                               \
  F(fb_quat_to_wiener_milenkovic, (fb_quat_to_wiener_milenkovic(p[0], p[1]), 0), ARITHMETIC, OUT(vec3), IN(q))         \
  F(fb_quat_from_wiener_milenkovic, (fb_quat_from_wiener_milenkovic(p[0], p[1]), 0), ARITHMETIC, OUT(vec4), IN(c))     \
  F(fb_pose_from_twist, (fb_pose_from_twist(p[0], p[1], p[2]), 0), ARITHMETIC, OUT(vec3), OUT(vec4), IN(twist))        \
  F(fb_pose_to_twist, (fb_pose_to_twist(p[0], p[1], p[2]), 0), ARITHMETIC, OUT(vec6), IN(a), IN(q))                    \
  F(fb_quat_normalize, fb_quat_normalize(p[0]), 1, STATE(q))                                                           \
  F(fb_lu_factor, fb_lu_factor(p[0], p[1], p[2], i[0]), 1, SPOILED(matrix), WORK(w.perm), WORK(w.scale), SIZE(4))      \
  F(fb_lu_solve, (fb_lu_solve(p[0], p[1], p[2], p[3], i[0]), 0), ARITHMETIC, OUT(vec4), IN(LU), MODEL(perm), IN(q),    \
    COUNT(4))                                                                                                          \
  F(fb_chol_factor, fb_chol_factor(p[0], i[0]), 1, SPOILED(definite), SIZE(4))                                         \
  F(fb_chol_solve, (fb_chol_solve(p[0], p[1], p[2], i[0]), 0), ARITHMETIC, OUT(vec4), IN(chol), IN(q), COUNT(4))       \
  F(fb_eig_sym_solve, fb_eig_sym_solve(p[0], p[1], p[2], i[0]), 1, WORK(eig_work), WORK(eig_work[4]),                  \
    SPOILED(definite), SIZE(4))                                                                                        \
  F(fb_eig_gen_solve, fb_eig_gen_solve(p[0], p[1], p[2], p[3], i[0]), 1, WORK(eig_work), WORK(eig_work[4]),            \
    SPOILED(matrix), SPOILED(definite), SIZE(4))                                                                       \
  F(fb_eig_general_solve, fb_eig_general_solve(p[0], p[1], p[2], p[3], p[4], i[0]), 1, WORK(spectrum_work.re),         \
    WORK(spectrum_work.im), WORK(spectrum_work.X), SPOILED(matrix), WORK(eig_work), SIZE(4))                           \
  F(fb_section_init, fb_section_init(p[0], p[1], p[2]), 1, OUT(fb_section), IN(material), IN(from))                    \
  F(fb_beam_desc_add_taper, fb_beam_desc_add_taper(p[0], p[1], p[2], p[3], i[0]), 1, STATE(taper), IN(material),       \
    IN(from), IN(to), WHOLE(2))                                                                                        \
  F(fb_beam_init, fb_beam_init(p[0], p[1]), 1, OUT(fb_beam), IN(beam_desc))                                            \
  F(fb_beam_section_eval, (fb_beam_section_eval(p[0], p[1], x[0]), 0), 0, MODEL(beam[0]), OUT(fb_section),             \
    REAL(FB_R(0.5)))                                                                                                   \
  F(fb_beam_matrices_eval, (fb_beam_matrices_eval(p[0], p[1], p[2]), 0), 0, MODEL(beam[0]), OUT(matrices),             \
    OUT(matrices))                                                                                                     \
  F(fb_modes_solve, fb_modes_solve(p[0], p[1], p[2], p[3]), 1, OUT(fb_modes), WORK(modes_work), MODEL(beam[0]),        \
    IN(modes_desc))                                                                                                    \
  F(fb_buckling_solve, fb_buckling_solve(p[0], p[1], p[2], p[3]), 1, OUT(fb_modes), WORK(modes_work), MODEL(beam[0]),  \
    IN(buckling_desc))                                                                                                 \
  F(fb_modes_join, fb_modes_join(p[0], p[1], p[2], p[3], p[4], i[0]), 1, OUT(fb_modes), WORK(join_work), MODEL(beam),  \
    MODEL(component), IN(join_desc), WHOLE(2))                                                                         \
  F(fb_effects_check, fb_effects_check((unsigned)i[0]), 1, WHOLE(31))                                                  \
  F(fb_shape_init, fb_shape_init(p[0], i[0]), 1, OUT(fb_shape), WHOLE(2))                                              \
  F(fb_shape_add_particle, fb_shape_add_particle(p[0], x[0], p[1], p[2], p[3]), 1, BUILT(empty), REAL(FB_R(1.5)),      \
    IN(r), IN(psi), OPTIONAL(chi))                                                                                     \
  F(fb_shape_add_rigid, fb_shape_add_rigid(p[0], x[0], p[1], p[2]), 1, BUILT(empty), REAL(FB_R(1.5)), IN(center),      \
    IN(inertia))                                                                                                       \
  F(fb_shape_add_lump, fb_shape_add_lump(p[0], x[0], p[1], p[2], p[3], p[4]), 1, BUILT(empty), REAL(FB_R(1.5)), IN(r), \
    OPTIONAL(inertia), IN(psi), IN(theta))                                                                             \
  F(fb_shape_add_node, fb_shape_add_node(p[0], p[1], p[2], p[3], p[4]), 1, BUILT(empty), OUT(int), IN(r), IN(psi),     \
    IN(theta))                                                                                                         \
  F(fb_shape_add_pair, fb_shape_add_pair(p[0], i[0], i[1], p[1], p[2], p[3]), 1, BUILT(empty), WHOLE(0), WHOLE(1),     \
    OPTIONAL(pchi), OPTIONAL(hchi), OPTIONAL(Gamchi))                                                                  \
  F(fb_shape_add_stiffening, fb_shape_add_stiffening(p[0], i[0], i[1], p[1], p[2], p[3]), 1, BUILT(empty), WHOLE(0),   \
    WHOLE(1), IN(pchi), IN(hchi), IN(spins))                                                                           \
  F(fb_fields_init, fb_fields_init(p[0], p[1], p[2], p[3], p[4], p[5]), 1, OUT(fb_fields), MODEL(empty),               \
    OPTIONAL(fields), IN(r), IN(psi), OPTIONAL(theta))                                                                 \
  F(fb_shape_add_field_lump, fb_shape_add_field_lump(p[0], p[1], x[0], p[2]), 1, BUILT(empty), IN(fields),             \
    REAL(FB_R(1.5)), OPTIONAL(inertia))                                                                                \
  F(fb_shape_add_field_node, fb_shape_add_field_node(p[0], p[1], p[2]), 1, BUILT(empty), OUT(int), IN(fields))         \
  F(fb_shape_add_beam, fb_shape_add_beam(p[0], i[0], p[1], p[2]), 1, BUILT(empty), WHOLE(0), MODEL(beam[0]),           \
    MODEL(modes))                                                                                                      \
  F(fb_shape_add_beam_node, fb_shape_add_beam_node(p[0], p[1], i[0], p[2], p[3], x[0]), 1, BUILT(shape), OUT(int),     \
    WHOLE(0), MODEL(beam[0]), MODEL(modes), REAL(FB_R(0.5)))                                                           \
  F(fb_gauge_init, fb_gauge_init(p[0], i[0], p[1], p[2], x[0], x[1], x[2]), 1, OUT(fb_gauge), WHOLE(0),                \
    MODEL(beam[0]), MODEL(modes), REAL(FB_R(0.5)), REAL(FB_R(0.1)), REAL(FB_R(0.1)))                                   \
  F(fb_gauge_eval, give(fb_gauge_eval(p[0], p[1])), 0, IN(gauge), IN(coordinates))                                     \
  F(fb_shape_add_beam_strain, fb_shape_add_beam_strain(p[0], i[0], p[1], p[2]), 1, BUILT(shape), WHOLE(0),             \
    MODEL(beam[0]), MODEL(modes))                                                                                      \
  F(fb_shape_select, fb_shape_select(p[0], p[1], p[2], i[0]), 1, OUT(fb_shape), MODEL(natural), IN(coordinate),        \
    WHOLE(2))                                                                                                          \
  F(fb_body_init, fb_body_init(p[0], p[1], p[2], p[3]), 1, OUT(fb_body), WORK(body_work), IN(shape), IN(body_desc))    \
  F(fb_body_build, fb_body_build(p[0], p[1], p[2], p[3], p[4], i[0]), SLOW, OUT(fb_body), WORK(build_work),            \
    IN(build_desc), IN(build_beam), IN(build_modes), WHOLE(2))                                                         \
  F(fb_body_scale, fb_body_scale(p[0], p[1], p[2], p[3]), 1, OUT(fb_body), WORK(body_work), MODEL(body), IN(factors))  \
  F(fb_body_check, fb_body_check(p[0]), 1, MODEL(body))                                                                \
  F(fb_body_crc, give((fb_real)fb_body_crc(p[0])), 0, MODEL(body))                                                     \
  F(fb_state_init, fb_state_init(p[0], p[1]), 1, MODEL(body), OUT(fb_state))                                           \
  F(fb_state_from_velocity, fb_state_from_velocity(p[0], p[1], p[2], p[3], p[4]), 1, MODEL(body), STATE(state), IN(v), \
    IN(w), OPTIONAL(q_dot))                                                                                            \
  F(fb_state_check, fb_state_check(p[0], p[1]), 1, MODEL(body), IN(state))                                             \
  F(fb_body_rates_eval, fb_body_rates_eval(p[0], p[1], p[2], p[3]), 1, MODEL(body), OUT(fb_state), IN(state),          \
    OPTIONAL(input))                                                                                                   \
  F(fb_body_motion_eval, fb_body_motion_eval(p[0], p[1], p[2], p[3]), 1, MODEL(body), OUT(fb_motion), IN(state),       \
    OPTIONAL(input))                                                                                                   \
  F(fb_body_node_motion_eval, fb_body_node_motion_eval(p[0], p[1], p[2], p[3], i[0]), 1, MODEL(body),                  \
    OUT(fb_node_motion), IN(state), IN(motion), WHOLE(1))                                                              \
  F(fb_body_lines_eval, fb_body_lines_eval(p[0], p[1], p[2], p[3], p[4], p[5]), 1, MODEL(bent), OUT(line_points),      \
    OUT(int), IN(bent_state), IN(bent_motion), OPTIONAL(input))                                                        \
  F(fb_body_node_loads_eval, fb_body_node_loads_eval(p[0], p[1], p[2], p[3], p[4], i[0]), 1, MODEL(bent),              \
    OUT(fb_node_loads), IN(bent_state), IN(bent_motion), OPTIONAL(input), WHOLE(1))                                    \
  F(fb_body_gravity_eval, fb_body_gravity_eval(p[0], p[1], p[2]), 1, MODEL(spun), OUT(vec3), IN(r))                    \
  F(fb_body_energy_eval, fb_body_energy_eval(p[0], p[1], p[2], p[3]), 1, MODEL(body), OUT(fb_energy), IN(state),       \
    OPTIONAL(input))                                                                                                   \
  F(fb_body_momentum_eval, fb_body_momentum_eval(p[0], p[1], p[2], p[3]), 1, MODEL(body), OUT(fb_momentum), IN(state), \
    OPTIONAL(input))                                                                                                   \
  F(fb_form_torque_add_beam, fb_form_torque_add_beam(p[0], p[1], i[0], p[2], p[3]), 1, BUILT(form_torque),             \
    MODEL(shape), WHOLE(0), MODEL(beam[0]), MODEL(modes))                                                              \
  F(fb_form_init, fb_form_init(p[0], p[1], p[2], p[3], p[4]), 1, OUT(fb_form_body), WORK(body_work), IN(shape),        \
    IN(body_desc), IN(form_desc))                                                                                      \
  F(fb_form_check, fb_form_check(p[0]), 1, MODEL(formed))                                                              \
  F(fb_form_crc, give((fb_real)fb_form_crc(p[0])), 0, MODEL(formed))                                                   \
  F(fb_form_state_from_velocity, fb_form_state_from_velocity(p[0], p[1], p[2], p[3], p[4]), 1, MODEL(formed),          \
    STATE(form_state), IN(v), IN(w), OPTIONAL(q_dot))                                                                  \
  F(fb_form_rates_eval, fb_form_rates_eval(p[0], p[1], p[2], p[3]), 1, MODEL(formed), OUT(fb_state), IN(form_state),   \
    OPTIONAL(input))                                                                                                   \
  F(fb_form_motion_eval, fb_form_motion_eval(p[0], p[1], p[2], p[3]), 1, MODEL(formed), OUT(fb_motion),                \
    IN(form_state), OPTIONAL(input))                                                                                   \
  F(fb_form_energy_eval, fb_form_energy_eval(p[0], p[1], p[2], p[3]), 1, MODEL(formed), OUT(fb_energy),                \
    IN(form_state), OPTIONAL(input))                                                                                   \
  F(fb_form_momentum_eval, fb_form_momentum_eval(p[0], p[1], p[2], p[3]), 1, MODEL(formed), OUT(fb_momentum),          \
    IN(form_state), OPTIONAL(input))                                                                                   \
  F(fb_form_step, fb_form_step(p[0], p[1], p[2], (fb_integrator)i[0], p[3], p[4], p[5], x[0], i[1]), 1, MODEL(formed), \
    STATE(form_state), WORK(form_work), WHOLE(2), IN(input), OPTIONAL(input), IN(input), REAL(FB_R(0.01)), WHOLE(2))   \
  F(fb_system_init, fb_system_init(p[0], p[1], p[2], p[3], i[0]), 1, OUT(fb_system), WORK(system_work), MODEL(body),   \
    IN(system_desc), WHOLE(1))                                                                                         \
  F(fb_system_check, fb_system_check(p[0], p[1], i[0]), 1, MODEL(system), MODEL(body), WHOLE(1))                       \
  F(fb_system_crc, give((fb_real)fb_system_crc(p[0], p[1], i[0])), 0, MODEL(system), MODEL(body), WHOLE(1))            \
  F(fb_system_state_check, fb_system_state_check(p[0], p[1], p[2]), 1, MODEL(system), MODEL(body), IN(system_state))   \
  F(fb_system_state_init, fb_system_state_init(p[0], p[1], p[2], p[3], p[4], p[5]), 1, MODEL(system), MODEL(body),     \
    OUT(fb_system_state), WORK(system_work), OPTIONAL(link_motion), OPTIONAL(system_input))                            \
  F(fb_system_axis_set, fb_system_axis_set(p[0], p[1], p[2], p[3], i[0], i[1], (fb_axis_mode)i[2], p[4]), 1,           \
    MODEL(system), MODEL(body), STATE(system_state), WORK(system_work), WHOLE(0), WHOLE(0), WHOLE(1),                  \
    OPTIONAL(system_input))                                                                                            \
  F(fb_system_rates_eval, fb_system_rates_eval(p[0], p[1], p[2], p[3], p[4], p[5]), 1, MODEL(system), MODEL(body),     \
    WORK(system_work), OUT(fb_system_state), IN(system_state), OPTIONAL(system_input))                                 \
  F(fb_system_motion_eval, fb_system_motion_eval(p[0], p[1], p[2], p[3], p[4], p[5]), 1, MODEL(system), MODEL(body),   \
    WORK(system_work), OUT(fb_system_motion), IN(system_state), OPTIONAL(system_input))                                \
  F(fb_system_lines_eval, fb_system_lines_eval(p[0], p[1], p[2], p[3], p[4], p[5], i[0]), 1, MODEL(bent_system),       \
    MODEL(bent), OUT(line_points), OUT(int), IN(bent_system_motion), OPTIONAL(system_input), WHOLE(0))                 \
  F(fb_system_node_loads_eval, fb_system_node_loads_eval(p[0], p[1], p[2], p[3], p[4], i[0], i[1]), 1,                 \
    MODEL(bent_system), MODEL(bent), OUT(fb_node_loads), IN(bent_system_motion), OPTIONAL(system_input), WHOLE(0),     \
    WHOLE(1))                                                                                                          \
  F(fb_system_energy_eval, fb_system_energy_eval(p[0], p[1], p[2], p[3], p[4], p[5]), 1, MODEL(system), MODEL(body),   \
    WORK(system_work), OUT(fb_energy), IN(system_state), OPTIONAL(system_input))                                       \
  F(fb_system_momentum_eval, fb_system_momentum_eval(p[0], p[1], p[2], p[3], p[4], p[5]), 1, MODEL(system),            \
    MODEL(body), WORK(system_work), OUT(fb_momentum), IN(system_state), OPTIONAL(system_input))                        \
  F(fb_imu_eval, (fb_imu_eval(p[0], p[1], p[2]), 0), 0, OUT(fb_imu), IN(node_motion), OPTIONAL(gravity))               \
  F(fb_exact_station_init, fb_exact_station_init(p[0], p[1]), 1, OUT(fb_exact_station), IN(section))                   \
  F(fb_exact_init, fb_exact_init(p[0], p[1]), 1, OUT(fb_exact), IN(exact_desc))                                        \
  F(fb_exact_crc, give((fb_real)fb_exact_crc(p[0])), 0, MODEL(exact))                                                  \
  F(fb_exact_check, fb_exact_check(p[0]), 1, MODEL(exact))                                                             \
  F(fb_exact_state_init, fb_exact_state_init(p[0], p[1], p[2], p[3]), 1, MODEL(exact), OUT(fb_exact_state),            \
    WORK(exact_work), OPTIONAL(exact_input))                                                                           \
  F(fb_exact_state_check, fb_exact_state_check(p[0], p[1]), 1, MODEL(exact), IN(exact_state))                          \
  F(fb_exact_trim, fb_exact_trim(p[0], p[1], p[2], p[3]), 1, MODEL(exact), STATE(exact_state), WORK(exact_work),       \
    OPTIONAL(exact_input))                                                                                             \
  F(fb_exact_nodes_eval, fb_exact_nodes_eval(p[0], p[1], p[2]), 1, MODEL(exact), OUT(nodes), IN(exact_state))          \
  F(fb_exact_element_eval, fb_exact_element_eval(p[0], p[1], p[2], i[0]), 1, MODEL(exact), OUT(fb_exact_element),      \
    IN(exact_state), WHOLE(1))                                                                                         \
  F(fb_exact_joint_eval, fb_exact_joint_eval(p[0], p[1], p[2], i[0]), 1, MODEL(exact), OUT(fb_exact_hinge),            \
    IN(exact_state), WHOLE(0))                                                                                         \
  F(fb_exact_point_eval, fb_exact_point_eval(p[0], p[1], p[2], p[3], x[0]), 1, MODEL(exact), OUT(vec3), OUT(vec4),     \
    IN(exact_state), REAL(FB_R(0.5)))                                                                                  \
  F(fb_exact_energy_eval, fb_exact_energy_eval(p[0], p[1], p[2]), 1, MODEL(exact), OUT(fb_energy), IN(exact_state))    \
  F(fb_exact_momentum_eval, fb_exact_momentum_eval(p[0], p[1], p[2]), 1, MODEL(exact), OUT(fb_momentum),               \
    IN(exact_state))                                                                                                   \
  F(fb_rk4_step, fb_rk4_step(p[0], p[1], p[2], p[3], p[4], p[5], x[0]), 1, MODEL(body), STATE(state), WORK(rk4_work),  \
    OPTIONAL(input), OPTIONAL(input), OPTIONAL(input), REAL(FB_R(0.01)))                                               \
  F(fb_body_limit_eval, fb_body_limit_eval(p[0], p[1], p[2], p[3]), 1, MODEL(body), OUT(fb_body_limit), IN(state),     \
    OPTIONAL(input))                                                                                                   \
  F(fb_rk4_limit, give(fb_rk4_limit(p[0], x[0], x[1])), 0, MODEL(body), REAL(1), REAL(1))                              \
  F(fb_implicit_limit, give(fb_implicit_limit(p[0], x[0], x[1])), 0, MODEL(body), REAL(1), REAL(1))                    \
  F(fb_midpoint_step, fb_midpoint_step(p[0], p[1], p[2], p[3], x[0], i[0]), 1, MODEL(body), STATE(state),              \
    WORK(implicit_work), OPTIONAL(input), REAL(FB_R(0.01)), WHOLE(2))                                                  \
  F(fb_sdirk_step, fb_sdirk_step(p[0], p[1], p[2], p[3], p[4], x[0], i[0]), 1, MODEL(body), STATE(state),              \
    WORK(implicit_work), IN(input), IN(input), REAL(FB_R(0.01)), WHOLE(2))                                             \
  F(fb_exponential_init, fb_exponential_init(p[0], p[1], p[2], x[0]), 1, OUT(fb_exponential), WORK(body_work),         \
    MODEL(body), REAL(FB_R(0.01)))                                                                                     \
  F(fb_exponential_check, fb_exponential_check(p[0], p[1]), 1, MODEL(exponential), MODEL(body))                        \
  F(fb_exponential_step, fb_exponential_step(p[0], p[1], p[2], p[3], p[4], p[5], p[6]), 1, MODEL(body),                \
    MODEL(exponential), STATE(state), WORK(exponential_work), OPTIONAL(input), OPTIONAL(input), OPTIONAL(input))       \
  F(fb_exponential_limit, give(fb_exponential_limit(p[0], x[0], x[1])), 0, MODEL(body), REAL(1), REAL(1))              \
  F(fb_system_rk4_step, fb_system_rk4_step(p[0], p[1], p[2], p[3], p[4], p[5], p[6], x[0]), 1, MODEL(system),          \
    MODEL(body), STATE(system_state), WORK(system_work), OPTIONAL(system_input), OPTIONAL(system_input),               \
    OPTIONAL(system_input), REAL(FB_R(0.001)))                                                                         \
  F(fb_system_sdirk_step, fb_system_sdirk_step(p[0], p[1], p[2], p[3], p[4], p[5], x[0], i[0]), 1, MODEL(system),      \
    MODEL(body), STATE(system_state), WORK(system_work), IN(system_input), IN(system_input), REAL(FB_R(0.001)),        \
    WHOLE(2))                                                                                                          \
  F(fb_system_limit_eval, fb_system_limit_eval(p[0], p[1], p[2], p[3], p[4], p[5]), 1, MODEL(system), MODEL(body),     \
    WORK(system_work), OUT(fb_system_limit), IN(system_state), OPTIONAL(system_input))                                 \
  F(fb_system_rk4_limit, give(fb_system_rk4_limit(p[0], p[1], x[0], x[1])), 0, MODEL(system), MODEL(body), REAL(1),    \
    REAL(1))                                                                                                           \
  F(fb_exact_step, fb_exact_step(p[0], p[1], p[2], p[3], x[0]), 1, MODEL(exact), STATE(exact_state), WORK(exact_work), \
    OPTIONAL(exact_input), REAL(FB_R(0.01)))                                                                           \
  F(fb_body_trim, fb_body_trim(p[0], p[1], p[2], p[3]), 1, MODEL(held), STATE(state), WORK(analyse_work), IN(input))   \
  F(fb_body_linearize, fb_body_linearize(p[0], p[1], p[2], p[3], p[4], p[5]), 1, MODEL(held), WORK(analyse_work),      \
    OUT(fb_linear), IN(state), IN(input), OPTIONAL(linear_desc))                                                       \
  F(fb_body_spectrum_solve, fb_body_spectrum_solve(p[0], p[1], p[2], p[3], p[4]), 1, MODEL(held), WORK(analyse_work),  \
    OUT(fb_spectrum), IN(state), IN(input))                                                                            \
  F(fb_system_trim, fb_system_trim(p[0], p[1], p[2], p[3], p[4]), SLOW, MODEL(system), MODEL(body),                    \
    STATE(system_state), WORK(system_analyse_work), OPTIONAL(system_input))                                            \
  F(fb_system_linearize, fb_system_linearize(p[0], p[1], p[2], p[3], p[4], p[5], p[6]), SLOW, MODEL(system),           \
    MODEL(body), WORK(system_analyse_work), OUT(fb_linear), IN(system_state), OPTIONAL(system_input),                  \
    OPTIONAL(system_linear_desc))                                                                                      \
  F(fb_system_spectrum_solve, fb_system_spectrum_solve(p[0], p[1], p[2], p[3], p[4], p[5]), SLOW, MODEL(system),       \
    MODEL(body), WORK(system_analyse_work), OUT(fb_spectrum), IN(system_state), OPTIONAL(system_input))                \
  F(fb_spectrum_damping, give(fb_spectrum_damping(p[0], i[0])), 0, IN(spectrum), WHOLE(0))                             \
  F(fb_spectrum_margin, give(fb_spectrum_margin(p[0], p[1], i[0])), 0, MAYBE(int), OPTIONAL(re), SIZE(4))              \
  F(fb_spectrum_limit, give(fb_spectrum_limit(p[0], (fb_integrator)i[0])), 0, IN(spectrum), WHOLE(0))                  \
  F(fb_spectrum_dt, give(fb_spectrum_dt(p[0], (fb_integrator)i[0], p[1], x[0], x[1])), 0, IN(spectrum), WHOLE(0),      \
    OPTIONAL(amplitude), REAL(1), REAL(FB_R(0.01)))                                                                    \
  F(fb_spectrum_error, give(fb_spectrum_error(p[0], (fb_integrator)i[0], p[1], x[0], x[1])), 0, IN(spectrum),          \
    WHOLE(0), OPTIONAL(amplitude), REAL(FB_R(0.01)), REAL(1))                                                          \
  F(fb_exact_spectrum_solve, fb_exact_spectrum_solve(p[0], p[1], p[2], p[3], p[4], i[0]), SLOW, MODEL(exact),          \
    WORK(spectrum_work), OUT(fb_exact_spectrum), IN(exact_state), OPTIONAL(exact_input), WHOLE(2))                     \
  F(fb_exact_path_step, fb_exact_path_step(p[0], p[1], p[2], p[3], p[4], p[5], x[0]), 1, MODEL(exact),                 \
    STATE(exact_path), STATE(exact_state), WORK(path_work), OPTIONAL(exact_input), IN(exact_input), REAL(FB_R(0.05)))  \
  F(fb_exact_linearize, fb_exact_linearize(p[0], p[1], p[2], p[3], p[4], p[5], i[0]), SLOW, MODEL(exact),              \
    WORK(linear_work), OUT(fb_exact_linear), IN(exact_state), OPTIONAL(exact_input), OPTIONAL(exact_linear_desc),      \
    WHOLE(2))                                                                                                          \
  F(fb_advice_solve, fb_advice_solve(p[0], p[1], p[2], p[3], p[4], x[0]), 1, OUT(fb_advice), WORK(advise_work),        \
    MODEL(natural), IN(scene_desc), IN(envelope), REAL(FB_R(0.1)))                                                     \
  F(fb_advice_search, fb_advice_search(p[0], p[1], p[2], p[3], p[4], x[0], p[5]), 1, OUT(fb_advice),                   \
    WORK(advise_work), MODEL(natural), IN(scene_desc), IN(envelope), REAL(FB_R(0.1)), IN(trial))                       \
  F(fb_stepper_init, fb_stepper_init(p[0], p[1]), 1, OUT(fb_stepper), IN(stepper_desc))                                \
  F(fb_stepper_step, fb_stepper_step(p[0]), 1, BUILT_TO(stepper, fb_stepper, work))                                    \
  F(fb_version_string, fb_version_string() ? 0 : -1, 0, REAL(0))                                                       \
  F(fb_config_string, fb_config_string() ? 0 : -1, 0, REAL(0))                                                         \
  F(fb_config_check, fb_config_check(p[0]), 1, MODEL(config))                                                          \
  F(fb_build_check, fb_build_check(), 0, REAL(0))                                                                      \
  OF_LINES(F)                                                                                                          \
  OF_ROTORS(F)

#define AS_CALL(function, call, has_status, ...) CALL(function, call)
FUNCTIONS(AS_CALL)

#define MOST 9
typedef struct argument {
  void *at;
  size_t size;
  char role;
  double value;
} argument;

typedef struct function {
  const char *name;
  int (*call)(void **p, const fb_real *x, const int *i);
  int has_status;
  argument argument[MOST];
} function;

#define AS_ROW(function, call, has_status, ...) {#function, call_##function, has_status, {__VA_ARGS__}},
static const function functions[] = {FUNCTIONS(AS_ROW)};

/* Pointers, and sizes of the caller's arrays, within structs: they stay. */
static const struct {
  const void *at;
  size_t size;
} untouched[] = {{&w.input.distributed, sizeof w.input.distributed},
                 {&w.input.user, sizeof w.input.user},
                 {&w.bent_input.distributed, sizeof w.bent_input.distributed},
                 {&w.bent_input.user, sizeof w.bent_input.user},
                 {&w.system_input.rows, sizeof w.system_input.rows},
                 {&w.system_input.forces, sizeof w.system_input.forces},
                 {&w.system_input.user, sizeof w.system_input.user},
                 {&w.system_input.distributed, sizeof w.system_input.distributed},
                 {&w.calm_system_input.rows, sizeof w.calm_system_input.rows},
                 {&w.calm_system_input.forces, sizeof w.calm_system_input.forces},
                 {&w.calm_system_input.user, sizeof w.calm_system_input.user},
                 {&w.calm_system_input.distributed, sizeof w.calm_system_input.distributed},
                 {&w.trial, sizeof w.trial},
                 {&w.stepper_desc, offsetof(fb_stepper_desc, n_input)},
                 {&w.stepper_desc.exponential, sizeof w.stepper_desc.exponential},
                 {&w.stepper_desc.iterations + 1, sizeof(int)}, /* no member */
                 {&w.beam_desc.n_point + 1, sizeof(int)}};

/* ---- the valid world */

static fb_status trial_run(void *user, fb_real *output, const fb_advice *candidate)
{
  (void)user;
  (void)candidate;
  for (int k = 0; k < 3; k++) {
    output[k] = FB_R(1.0);
  }
  return FB_OK;
}

/* Forces by the motion of a load's node and of a spring. */
static fb_status hold_back(fb_system_forces *now, void *user)
{
  (void)user;
  for (int i = 0; i < 3 && now->n_point > 0; i++) {
    now->point[0].force[i] = -FB_R(0.1) * now->point[0].velocity[i];
  }
  now->pull[0] = now->n_spring > 0 ? FB_R(0.1) * now->spring[0].rate : FB_R(0.0);
  return FB_OK;
}

/* A force that opposes the velocity. */
static fb_status drag(fb_line_point *point, int n, fb_real t, void *user)
{
  (void)t;
  (void)user;
  for (int k = 0; k < n; k++) {
    for (int i = 0; i < 3; i++) {
      point[k].force[i] = -point[k].length * point[k].velocity[i];
    }
  }
  return FB_OK;
}

static void need(fb_status status, const char *what)
{
  if (status != FB_OK) {
    printf("the valid world: %s: %s\n", what, fb_status_string(status));
    exit(1);
  }
}

static void numbers_fill(void)
{
  static const fb_real S[21] = {4, 0, 0, 0, 1, 0, 4, 0, 1, 0, 0, 4, 0, 0, 0, 3, 0, 0, 3, 0, 3};
  for (int k = 0; k < 9; k++) {
    w.A[k] = (fb_real)(k + 1);
    w.B[k] = (fb_real)(9 - k);
  }
  for (int k = 0; k < 3; k++) {
    w.a[k] = w.twist[k] = w.twist[k + 3] = w.c[k] = FB_R(0.3);
    w.b[k] = (fb_real)k;
    w.r[k] = w.pchi[k] = w.hchi[k] = w.v[k] = w.w[k] = w.gravity[k] = FB_R(0.2);
    w.inertia[k] = FB_R(2.0);
  }
  for (int k = 0; k < 6; k++) {
    w.y[k] = FB_R(1.0);
  }
  memcpy(w.S, S, sizeof S);
  w.q[0] = FB_R(1.0);
  for (int k = 0; k < 4; k++) {
    for (int j = 0; j < 4; j++) {
      w.matrix[4 * k + j] = w.definite[4 * k + j] = FB_R(1.0) / (fb_real)(1 + k + j) + (k == j ? FB_R(1.0) : FB_R(0.0));
    }
    w.re[k] = -FB_R(1.0);
  }
  memcpy(w.LU, w.matrix, sizeof w.LU);
  memcpy(w.chol, w.matrix, sizeof w.LU);
  need(fb_lu_factor(w.LU, w.perm, w.scale, 4), "LU");
  need(fb_chol_factor(w.chol, 4), "Cholesky");
  for (int k = 0; k < 3 * FB_MAX_MODES; k++) {
    w.psi[k] = w.theta[k] = FB_R(0.1) * (fb_real)(k + 1);
  }
}

static void beam_fill(void)
{
  w.material.E = w.material.G = FB_R(7e7);
  w.material.density = FB_R(2700.0);
  w.from.size[0] = w.from.size[1] = w.to.size[0] = w.to.size[1] = FB_R(0.1);
  w.to.x = FB_R(1.0);
  w.section.mass = FB_R(1.0);
  w.section.EA = FB_R(1e4);
  w.section.GJ = w.section.EI_y = w.section.EI_z = FB_R(100.0);
  w.section.i_y = w.section.i_z = FB_R(0.01);
  w.beam_desc.length = FB_R(2.0);
  w.beam_desc.n_element = 2;
  w.beam_desc.n_station = 1;
  w.beam_desc.station[0] = w.section;
  need(fb_beam_init(&w.beam[0], &w.beam_desc), "beam");
  w.modes_desc.count[FB_KIND_BEND_Y] = w.modes_desc.count[FB_KIND_BEND_Z] = 1;
  need(fb_modes_solve(&w.modes, &modes_work, &w.beam[0], &w.modes_desc), "modes");
  w.buckling_desc.count[FB_KIND_BEND_Y] = 1;
  w.buckling_desc.preload.force = -FB_R(1.0);
  w.component_desc = w.modes_desc;
  w.component[0] = w.modes;
  w.component_desc.rigid = 1;
  w.beam_desc.root = FB_ROOT_FREE;
  w.beam_desc.position[0] = FB_R(2.0);
  need(fb_beam_init(&w.beam[1], &w.beam_desc), "second beam");
  w.beam_desc.root = FB_ROOT_CLAMPED;
  w.beam_desc.position[0] = FB_R(0.0);
  w.component_desc.count[FB_KIND_BEND_Y] = 0;
  w.component_desc.count[FB_KIND_BEND_Z] = 0;
  w.component_desc.count[FB_KIND_AXIAL] = 1;
  need(fb_modes_solve(&w.component[1], &modes_work, &w.beam[1], &w.component_desc), "component");
  w.join_desc.n_weld = 1;
  w.join_desc.lowest = 2;
  w.join_desc.weld[0].component[1] = 1;
  w.join_desc.weld[0].node[0] = 2;
}

static void body_fill(void)
{
  int node;
  need(fb_shape_init(&w.empty, 2), "empty shape");
  need(fb_shape_init(&w.shape, w.modes.n), "shape");
  need(fb_shape_add_rigid(&w.shape, FB_R(20.0), w.center, w.inertia), "hub");
  need(fb_shape_add_beam(&w.shape, 0, &w.beam[0], &w.modes), "beam of the shape");
  w.natural = w.shape;
  need(fb_shape_add_beam_node(&w.natural, &node, 0, &w.beam[0], &w.modes, FB_R(2.0)), "tip");
  w.body_desc.effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING | FB_EFFECT_GRAVITY;
  w.body_desc.gravity[2] = -FB_R(1.0);
  w.body_desc.zeta[0] = w.body_desc.zeta[1] = FB_R(0.01);
  need(fb_body_init(&w.body, &body_work, &w.natural, &w.body_desc), "body");
  w.factors.stiffness = w.factors.damping = w.factors.mass = FB_R(1.5);
  w.factors.hub_mass = w.factors.hub_inertia = FB_R(1.1);
  w.factors.hub = FB_R(0.1) * w.body.mass;
  need(fb_body_scale(&w.held, &body_work, &w.body, &w.factors), "body by factors");
  w.form_desc.form = FB_FORM_SECOND;
  need(fb_form_init(&w.formed, &body_work, &w.natural, &w.body_desc, &w.form_desc), "body in the second-order form");
  w.build_desc.mass = FB_R(5.0);
  w.build_desc.inertia[0] = w.build_desc.inertia[1] = w.build_desc.inertia[2] = FB_R(2.0);
  w.build_beam[0] = w.build_beam[1] = w.beam_desc;
  w.build_beam[1].root = FB_ROOT_FREE;
  w.build_modes[0] = w.modes_desc;
  w.build_modes[1] = w.component_desc;
  w.build_desc.n_part = 2;
  w.build_desc.part[0].n_node = w.build_desc.part[1].beam = 1;
  w.build_desc.part[0].node[0] = w.build_desc.part[1].position[0] = w.beam_desc.length;
  w.build_desc.join = w.join_desc;
  w.build_desc.body = w.body_desc;
  need(fb_body_build(&w.held, &build_work, &w.build_desc, w.build_beam, w.build_modes, 2), "body in one call");
  w.bent_desc = w.body_desc;
  w.bent_desc.effects |= FB_EFFECTS_LARGE;
  need(fb_body_init(&w.bent, &body_work, &w.natural, &w.bent_desc), "body with lines");
  need(fb_state_init(&w.bent, &w.bent_state), "its state");
  w.bent_input.distributed = drag;
  w.spun_desc = w.body_desc;
  w.spun_desc.mu = FB_R(100.0);
  w.spun_desc.center[1] = FB_R(40.0);
  w.spun_desc.n_rotor = 2;
  w.spun_desc.rotor[0].axis[0] = w.spun_desc.rotor[1].axis[2] = FB_R(1.0);
  w.spun_desc.rotor[0].inertia = w.spun_desc.rotor[1].inertia = FB_R(0.01);
  w.spun_desc.rotor[0].given = 1;
  w.spun_desc.rotor[1].node = 1;
  w.spun_desc.rotor[1].friction = FB_R(1e-4);
  w.spun_desc.rotor[1].friction_speed = FB_R(0.1);
  w.spun_desc.rotor[1].static_imbalance = w.spun_desc.rotor[1].dynamic_imbalance = FB_R(1e-4);
  need(fb_body_init(&w.spun, &body_work, &w.natural, &w.spun_desc), "body with rotors");
  need(fb_state_init(&w.spun, &w.spun_state), "its state");
  w.spun_input.rotor[0].momentum = FB_R(1e-3);
  need(fb_state_rotor_set(&w.spun, &w.spun_state, 1, FB_R(2.0), FB_R(0.1), &w.spun_input), "its wheel");
  need(fb_exponential_init(&w.spun_exponential, &body_work, &w.spun, FB_R(0.01)), "its exponential scheme");
  w.scene_desc = w.spun_desc;
  w.scene_desc.mu = FB_R(0.0);
  memset(w.scene_desc.center, 0, sizeof w.scene_desc.center);
  w.scene_desc.base = FB_BASE_PRESCRIBED;
  w.scene_desc.rotor[1].static_imbalance = w.scene_desc.rotor[1].dynamic_imbalance = FB_R(0.0);
  need(fb_body_init(&w.calm, &body_work, &w.natural, &w.scene_desc), "balanced body with rotors");
  w.wheel_desc = w.scene_desc;
  need(fb_state_init(&w.calm, &w.calm_state), "its state");
  w.scene_desc.base = FB_BASE_FREE;
  w.scene_desc.mu = FB_R(1e7);
  memset(w.scene_desc.gravity, 0, sizeof w.scene_desc.gravity);
  w.scene_desc.rotor[1].friction = w.scene_desc.rotor[1].friction_speed = FB_R(0.0);
  need(fb_body_init(&w.orbit, &body_work, &w.natural, &w.scene_desc), "body in orbit");
  need(fb_state_init(&w.orbit, &w.orbit_state), "its state");
  w.orbit_state.rho[0] = FB_R(1000.0);
  w.orbit_input.w[2] = FB_R(0.1);
  need(fb_body_trim(&w.orbit, &w.orbit_state, &analyse_work, &w.orbit_input), "its steady state");
  w.scene_desc = w.bent_desc;
  w.scene_desc.base = FB_BASE_PRESCRIBED;
  need(fb_body_init(&w.bent_held, &body_work, &w.natural, &w.scene_desc), "held body with lines");
  need(fb_exponential_init(&w.bent_exponential, &body_work, &w.bent, FB_R(0.01)), "its exponential scheme");
  w.scene_desc = w.body_desc;
  w.scene_desc.base = FB_BASE_PRESCRIBED;
  need(fb_body_init(&w.held, &body_work, &w.natural, &w.scene_desc), "held body");
  w.coordinate[1] = 1;
  need(fb_gauge_init(&w.gauge, 0, &w.beam[0], &w.modes, FB_R(0.5), FB_R(0.1), FB_R(0.1)), "gauge");
  need(fb_state_init(&w.body, &w.state), "state");
  need(fb_state_init(&w.formed.body, &w.form_state), "state in the second-order form");
  w.form_state.q[0] = FB_R(0.01);
  w.input.n_load = 1;
  w.input.load[0].node = 1;
  w.input.load[0].force[1] = FB_R(0.1);
  need(fb_body_motion_eval(&w.body, &w.motion, &w.state, &w.input), "motion");
  need(fb_body_motion_eval(&w.bent, &w.bent_motion, &w.bent_state, &w.input), "motion of the body with lines");
  need(fb_body_node_motion_eval(&w.body, &w.node_motion, &w.state, &w.motion, 1), "motion of a node");
  need(fb_exponential_init(&w.exponential, &body_work, &w.body, FB_R(0.01)), "exponential scheme");
  w.stepper_desc.body = &w.body;
  w.stepper_desc.state = &w.state;
  w.stepper_desc.input = &w.input;
  w.stepper_desc.exponential = &w.exponential;
  w.stepper_desc.dt = FB_R(0.01);
  w.stepper_desc.integrator = FB_INTEGRATOR_EXPONENTIAL;
  need(fb_stepper_init(&w.stepper, &w.stepper_desc), "stepper");
  w.linear_desc.n_in = w.linear_desc.n_out = 1;
  w.linear_desc.in[0].node = w.linear_desc.out[0].node = 1;
  w.linear_desc.out[0].kind = FB_PORT_DISPLACEMENT;
  w.motor_desc = w.linear_desc;
  w.motor_desc.in[0].kind = FB_PORT_MOTOR;
  w.motor_desc.out[0].kind = FB_PORT_ROTOR_SPEED;
  need(fb_body_spectrum_solve(&w.held, &analyse_work, &w.spectrum, &w.state, &w.input), "spectrum");
  w.envelope.n_load = 1;
  w.envelope.load[0] = w.input.load[0];
  w.envelope.duration = FB_R(1.0);
  w.envelope.node = 1;
  w.envelope.rotor[0].momentum = w.envelope.rotor[1].torque = FB_R(1e-3);
  w.trial.run = trial_run;
  w.trial.n = w.trial.width = 3;
  w.trial.output = trial_output;
  w.trial.reference = trial_reference;
}

static void system_fill(void)
{
  w.system_desc.n_body = 2;
  w.system_desc.joint[0].kind = w.system_desc.joint[1].kind = FB_JOINT_REVOLUTE;
  w.system_desc.joint[0].parent = FB_GROUND;
  w.system_desc.joint[1].parent_node = 1;
  w.system_desc.joint[0].stiffness[0] = w.system_desc.joint[1].stiffness[0] = FB_R(1000.0);
  w.system_desc.joint[1].friction[0] = w.system_desc.joint[1].friction_speed[0] = FB_R(0.1);
  w.system_desc.joint[1].stop[0][0] = FB_R(-0.5);
  w.system_desc.joint[1].stop[0][1] = FB_R(0.5);
  w.system_desc.joint[1].stop_stiffness[0] = FB_R(10.0);
  w.system_desc.joint[1].stop_loss[0] = FB_R(0.1);
  w.system_desc.n_spring = 1;
  w.system_desc.spring[0].node[0] = 1;
  w.system_desc.spring[0].body[1] = FB_GROUND;
  w.system_desc.spring[0].position[1][1] = FB_R(3.0);
  w.system_desc.spring[0].stiffness = FB_R(0.01);
  w.system_desc.spring[0].damping = FB_R(0.01);
  need(fb_system_init(&w.system, &system_work, &w.body, &w.system_desc, 1), "system");
  need(fb_system_state_init(&w.system, &w.body, &w.system_state, &system_work, NULL, NULL), "state of the system");
  need(fb_system_init(&w.bent_system, &system_work, &w.bent, &w.system_desc, 1), "system with lines");
  need(fb_system_state_init(&w.bent_system, &w.bent, &w.bent_system_state, &system_work, NULL, NULL), "its state");
  need(fb_system_motion_eval(&w.bent_system, &w.bent, &system_work, &w.bent_system_motion, &w.bent_system_state, NULL),
       "its motion");
  need(fb_system_init(&w.calm_system, &system_work, &w.calm, &w.system_desc, 1), "system with rotors");
  w.link_motion[0].rotor_speed[1] = FB_R(2.0);
  w.calm_system_input.rotor[0][0].momentum = w.calm_system_input.rotor[1][0].torque = FB_R(1e-3);
  need(fb_system_state_init(&w.calm_system, &w.calm, &w.calm_system_state, &system_work, w.link_motion,
                            &w.calm_system_input),
       "its state");
  w.system_input.n_load = 1;
  w.system_input.load[0].load = w.input.load[0];
  w.system_input.forces = hold_back;
  w.system_linear_desc = w.linear_desc;
  w.system_linear_desc.in[0].kind = FB_PORT_DRIVE;
}

static void exact_fill(void)
{
  need(fb_exact_station_init(&w.exact_station, &w.section), "station");
  w.exact_desc.length = FB_R(2.0);
  w.exact_desc.n_element = 3;
  w.exact_desc.n_joint = 1;
  w.exact_desc.joint[0].element = 1;
  w.exact_desc.joint[0].axis[2] = FB_R(1.0);
  w.exact_desc.joint[0].stiffness = FB_R(50.0);
  w.exact_desc.n_branch = 1;
  w.exact_desc.branch[0].node = 1;
  w.exact_desc.branch[0].n_element = 2;
  w.exact_desc.branch[0].attitude[0] = w.exact_desc.branch[0].attitude[3] = FB_R(0.5);
  w.exact_desc.n_station = 1;
  w.exact_desc.station[0] = w.exact_station;
  w.exact_desc.gravity[2] = -FB_R(1.0);
  need(fb_exact_init(&w.exact, &w.exact_desc), "exact beam");
  need(fb_exact_state_init(&w.exact, &w.exact_state, &exact_work, NULL), "its state");
  w.exact_input.n_load = 1;
  w.exact_input.load[0].node = 3;
  w.exact_input.load[0].force[1] = FB_R(1.0);
  need(fb_exact_trim(&w.exact, &w.exact_state, &exact_work, &w.exact_input), "its steady state");
  w.exact_linear_desc.n_in = w.exact_linear_desc.n_out = 1;
  w.exact_linear_desc.in[0].node = w.exact_linear_desc.out[0].node = 2;
  w.exact_linear_desc.out[0].kind = FB_PORT_VELOCITY;
}

/* ---- calls and what they leave */

#define ROOM (1 << 20)
static union { /* outputs, with the pattern before each call */
  unsigned char byte[ROOM];
  fb_real align;
} out;
static const unsigned char pattern = 0x5A; /* as a number: finite */

typedef struct call {
  void *p[MOST];
  fb_real x[MOST];
  int i[MOST];
  int role[MOST]; /* place of each argument in p, x or i */
} call;

static inline int is_pointer(const argument *a)
{
  return strchr("i?smbxoOw", a->role) != NULL;
}

static inline size_t rounded(size_t size)
{
  return (size + 63) / 64 * 64;
}

/* Arguments as they should be. */
static inline void prepare(call *c, const function *f)
{
  int n[3] = {0, 0, 0};
  size_t used = 0;
  for (int k = 0; k < MOST && f->argument[k].role; k++) {
    const argument *a = &f->argument[k];
    if (a->role == 'r') {
      c->role[k] = n[1];
      c->x[n[1]++] = (fb_real)a->value;
    } else if (!is_pointer(a)) {
      c->role[k] = n[2];
      c->i[n[2]++] = (int)a->value;
    } else {
      c->role[k] = n[0];
      if (a->at == NULL) {
        memset(out.byte + used, pattern, rounded(a->size));
        c->p[n[0]++] = out.byte + used;
        used += rounded(a->size);
      } else {
        if (a->role != 'w') {
          memcpy(a->at, (char *)&kept + ((char *)a->at - (char *)&w), a->size);
        }
        c->p[n[0]++] = a->at;
      }
    }
  }
  if (used > ROOM) {
    printf("%s: ROOM is too small\n", f->name);
    exit(1);
  }
}

/* Neither a NaN nor an infinity in whole words; -1 next to anything is a whole number. */
static int is_finite(const void *at, size_t size)
{
  for (size_t k = 0; k + sizeof(fb_real) <= size; k += sizeof(fb_real)) {
    uint32_t high;
    fb_real value;
    memcpy(&value, (const char *)at + k, sizeof value);
    memcpy(&high, (const char *)at + k + sizeof value - sizeof high, sizeof high);
    if (!isfinite(value) && high != 0xFFFFFFFFu && high != 0x7FFFFFFFu) {
      return 0;
    }
  }
  return 1;
}

static inline int is_touchable(const void *at)
{
  for (int k = 0; k < (int)(sizeof untouched / sizeof *untouched); k++) {
    const char *from = (const char *)untouched[k].at;
    if ((const char *)at >= from && (const char *)at < from + untouched[k].size) {
      return 0;
    }
  }
  return 1;
}

static void world_fill(void)
{
  numbers_fill();
  beam_fill();
  body_fill();
  system_fill();
  exact_fill();
  strcpy(w.config, FB_CONFIG);
  memcpy(&kept, &w, sizeof w);
}

#endif
