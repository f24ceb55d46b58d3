/* flexbeam.h - 0.2.0 - flexible bodies in real time, a header-only C99 library

   Spacecraft with booms and solar arrays, rotor blades, robot links: the library computes the modes of a beam from its
   section properties or takes them from a finite-element model, makes a flexible body of them, connects bodies by
   joints, and integrates the motion with a fixed step. A step has bounded work that does not depend on the data,
   allocates nothing, and needs nothing beyond libc and libm, on the desktop as on a microcontroller.

   A body is described in a floating frame of reference with assumed modes, in momentum form:

     q_dot  = M^-1 ( pi - Lambda(q)^T V )                           V = (v, w) = S(q)^-1 y
     pi_dot = f_e - K q - C q_dot + d/dq ( V^T Lambda pbar + 1/2 V^T S V )       pbar = M^-1 pi
     m u_dot = R f,   L_dot = R g                                   y = (0, R^T L) - Lambda(q) pbar

   q are the generalized coordinates of the modes, pi their conjugate momenta, u the velocity of the mass center and L
   the angular momentum about it; f, g and f_e are force, moment and modal loads. V, the velocity of the frame, and pi
   are relative to u, so that the speed of flight does not matter. The only matrix that depends on q is the 6x6 Schur
   complement S(q) = M_rr(q) - Lambda(q) M^-1 Lambda(q)^T, a polynomial of degree 2 in q. Its terms are collected once,
   at init, for the selected effects alone: an effect that is off costs nothing. A beam that bends far takes the same
   modes as modes of curvature, and is geometrically exact (FB_EFFECTS_LARGE).

   QUICK START (examples/quickstart.c; do this in ONE file, the others include flexbeam.h alone)

     #define FB_WITH_DETAIL 1   // says what was refused
     #define FB_WITH_OPTIONAL 0 // 1: rotors, beams that bend far; twice the compile time
     #define FLEXBEAM_IMPLEMENTATION
     #include "flexbeam.h"
     #include <stdio.h>

     static fb_body body;
     static fb_build_work build_work;

     int main(void)
     {
       const fb_section uniform = {.mass = FB_R(1.2), .EI_y = 14004, .EI_z = 14004}; // [kg/m], [N m^2]
       const fb_beam_desc boom = {.length = 10, .n_element = 10, .n_station = 1, .station = {uniform}};
       const fb_modes_desc keep = {.count = {3, 3}}; // bending modes along y, along z
       const fb_build_desc craft = {.mass = 500,     // of the hub [kg], [kg m^2]
                                    .inertia = {80, 80, 80},
                                    .n_part = 1, // the boom; its tip is node 1
                                    .part = {{.n_node = 1, .node = {10}}},
                                    .body = {.effects = FB_EFFECTS_FULL}}; // FB_EFFECTS_LARGE and OPTIONAL 1: bends far
       const fb_input torque = {.n_load = 1, .load = {{.torque = {0, 0, 160}}}}; // [N m] at node 0, inertial axes
       fb_state state;
       fb_rk4_work work;
       fb_motion motion;
       fb_node_motion tip;
       fb_status status = fb_body_build(&body, &build_work, &craft, &boom, &keep, 1); // on the desktop or at start-up
       status = status ? status : fb_state_init(&body, &state);
       for (int k = 0; k < 1000 && status == FB_OK; k++) { // run: one step of 1 ms
         status = fb_rk4_step(&body, &state, &work, &torque, &torque, &torque, FB_R(0.001));
       }
       status = status ? status : fb_body_motion_eval(&body, &motion, &state, &torque);
       status = status ? status : fb_body_node_motion_eval(&body, &tip, &state, &motion, 1);
       if (status != FB_OK) {
         printf("%s\n", fb_status_string(status));
         const fb_detail *no = fb_detail_last();
         if (no->status == status) { // this refusal has a record: what it wants, what it found
           printf("%s: %s %g: %g\n", no->function, no->what, (double)no->need, (double)no->have);
         }
         return 1;
       }
       printf("after 1 s: hub %.4f rad/s, tip %.4f m\n", (double)motion.w[2], (double)tip.displacement[1]);
       return fflush(stdout) == 0 ? 0 : 1;
     }

   A SYSTEM of bodies (examples/arm.c, spacecraft.c, rotor.c, fourbar.c): two links like the body above, node 1 its tip

     static const fb_system_desc arm = {
         .n_body = 2, // both of model 0; z of a joint is its axis
         .joint = {{.kind = FB_JOINT_REVOLUTE, .parent = FB_GROUND},
                   {.kind = FB_JOINT_REVOLUTE, .parent = 0, .parent_node = 1, .damping = {FB_R(0.1)}}}};
     static const fb_system_input elbow = {.drive[1].torque = {200}}; // [N m]
     static fb_system system;
     static fb_system_work work;
     static fb_system_state state;
     static fb_system_motion motion;
     status = status ? status : fb_system_init(&system, &work, &body, &arm, 1);
     status = status ? status : fb_system_state_init(&system, &body, &state, &work, NULL, NULL); // or angles, speeds
     for (int k = 0; k < 1000 && status == FB_OK; k++) {
       status = fb_system_rk4_step(&system, &body, &state, &work, &elbow, &elbow, &elbow, FB_R(0.001));
     }
     status = status ? status : fb_system_motion_eval(&system, &body, &work, &motion, &state, &elbow); // joint forces

   A GEOMETRICALLY EXACT BEAM, for any deflection (examples/elastica.c, follower.c, flap.c, whirl.c)

     desc = (fb_exact_desc){.length = 10, .n_element = 20, .n_station = 1};      // clamped root, free tip
     status = fb_exact_station_init(&desc.station[0], &uniform);                  // or 6x6 stiffness and inertia
     status = status ? status : fb_exact_init(&exact, &desc);
     status = status ? status : fb_exact_state_init(&exact, &state, &work, &input);
     input.w[2] = FB_R(6.0);                                                      // [rad/s] of the base
     status = status ? status : fb_exact_trim(&exact, &state, &work, &input);     // steady state
     status = status ? status : fb_exact_step(&exact, &state, &work, &input, dt); // motion from there
     status = status ? status : fb_exact_nodes_eval(&exact, node, &state);        // displacements, rotations, loads
     status = status ? status : fb_exact_spectrum_solve(&exact, &spectrum_work, &spectrum, &state, &input, 6); // modes

   CONTENTS (search for the anchor; flexbeam_impl.h has the same ones. A section uses only those above it: RUN is what
   flies, BUILD makes models of bodies, systems and exact beams, ANALYSE computes steady states and linear models)
     RUN        >>config     options, real type, libm hooks, mismatch guard
                >>status     status codes and their texts
                >>vec3       3-vectors, 3x3 and symmetric 6x6 matrices
                >>rotation   unit quaternions, exponential and logarithm
                >>solve      LU and Cholesky factors
                >>line       geometrically exact lines: the beams of a body that bend far
                >>body       one body: effects, state, loads, motion, nodes, sensors, energy
                >>system     bodies on joints: trees, loops, constraints
                >>exact      the geometrically exact beam
                >>integrate  every step and its limit: rk4, implicit midpoint, SDIRK2, exponential, exact beam
                >>version    version and configuration string
     BUILD      >>eigen      symmetric, generalized and general eigenproblems
                >>beam       sections, tapers, stations, bent lines, lumped bodies, element matrices
                >>modes      natural modes, components, buckling, synthesis; finite-element coordinates
                >>assemble   shape integrals; every _init of a model: bodies, systems, exact beams
                >>forms      the second-order and the first-order form of [DB], for comparison
     ANALYSE    >>trim       steady states and their paths
                >>linear     linear models, complex modes, step advice
                >>advise     which effects, modes, integrator and step a scene calls for
     all        >>scratch    of flexbeam.h alone: what is in the work structs that functions take

   OPTIONS (define them before the include, the same in every file: files with different options do not link. Best put
   them into one file and name it in every compiler call: -DFLEXBEAM_CONFIG='"my_config.h"'. Values are bare numbers.)
     macro                            default  range   meaning
     FLEXBEAM_IMPLEMENTATION          -        -       defined in one file: the code is compiled there
     FLEXBEAM_STATIC                  -        -       private copy in this file (float and double in one program)
     FB_SINGLE                        0        0, 1    1: fb_real is float
     FB_MAX_MODES                     12       1..60   elastic coordinates of a body
     FB_MAX_NODES                     8        1..255  nodes of a body that carry loads or sensors (node 0 = O)
     FB_MAX_LOADS                     8        1..255  loads on a body at a time
     FB_MAX_ELEMENTS                  20       1..200  finite elements of a beam (model building only)
     FB_MAX_STATIONS                  64       1..999  stations of a beam (model building only)
     FB_MAX_LUMPS                     8        1..255  lumped bodies on a beam (model building only)
     FB_MAX_BODIES                    8        1..99   bodies of a system
     FB_MAX_LOOPS                     4        1..99   joints that close its loops
     FB_MAX_SPRINGS                   4        1..99   its springs, dampers and actuators between points
     FB_MAX_ROWS                      24       1..999  its constraints: loops, the caller's
     FB_MAX_SPEEDS                    64       6..999  its speeds, FB_METHOD_DENSE and linear models only
     FB_MAX_PORTS                     12       1..255  inputs of a linear model, and its outputs
     FB_MAX_EXACT                     40       1..999  elements of an exact beam, of all its branches
     FB_WITH_SPIN_COUPLING            1        0, 1    0 removes the effect's code and tables at compile time
     FB_WITH_RESIDUAL_INERTIA         1        0, 1    "
     FB_WITH_SPIN_STIFFENING          1        0, 1    "
     FB_WITH_ACCELERATION_STIFFENING  1        0, 1    "
     FB_WITH_DAMPING                  1        0, 1    "
     FB_WITH_GRAVITY                  1        0, 1    "
     FB_WITH_NONLINEAR_STRAIN         OPTIONAL 0, 1    "
     FB_WITH_LARGE_DEFLECTION         OPTIONAL 0, 1    "
     FB_WITH_ROTORS                   OPTIONAL 0, 1    "
     FB_WITH_OPTIONAL                 1        0, 1    of these three; with 0 one body compiles twice as fast
     FB_MAX_ROTORS                    4        1..99   rotors of a body
     FB_MAX_STRAINS                   24       1..999  strain stations of a body (nonlinear strain only)
     FB_MAX_POINTS                    32       2..998  points of a body's lines (large deflection only), even
     FB_MAX_LINES                     8        1..99   its lines: beams of a body (large deflection only)
     FB_MAX_LINE_ROWS,                0        0..     rows and numbers in the tables of the lines; 0: as many as there
     FB_MAX_LINE_TABLE                                 can be. As FB_MAX_LAMBDA for models in ROM
     FB_MAX_LAMBDA, FB_MAX_S          0       0..     terms of Lambda(q) and S(q) that a body holds; 0: as many as
                                                      there can be. For models in ROM: build/flexbeam reduce (make
                                                      tool) tells what one takes
     FB_WITH_FORMS                    0        0, 1    1: fb_form_..., the equations of [DB]. No struct
                                                       depends on it: it may differ between files
     FB_WITH_SYSTEM                   1        0, 1    0 removes systems of bodies: their types, functions and code
     FB_WITH_EXACT                    1        0, 1    0 removes the geometrically exact beam
     FB_WITH_BUILD                    1        0, 1    0 removes BUILD: for firmware whose models are in ROM
     FB_WITH_ANALYSE                  as BUILD 0, 1    0 removes ANALYSE
     FB_WITH_DETAIL                   0        0, 1    1: fb_detail_last says what was refused and why; for desktops
                                                       (texts, thread-local storage). No struct depends on it: it may
                                                       differ between files, which call fb_detail_last if it is 1 in
                                                       the one that has the code
     FB_ASSERT(x)                     nothing  -       called with 0 on a programmer's error (NULL, index, capacity)
     FB_ALLOW_FAST_MATH               -        -       compile under -ffast-math (finite checks are then void, and
                                                       small increments are lost). Without it refused are -ffast-math,
                                                       -Ofast, /fp:fast, -ffinite-math-only, -fassociative-math,
                                                       -funsafe-math-optimizations: by #error where the compiler tells
                                                       (of the last two gcc from 12 on does, clang does not), else every
                                                       _init returns FB_ERR_BUILD; see fb_build_check. Other bits,
                                                       but good ones, come from -fno-signed-zeros, -freciprocal-math,
                                                       -ffp-contract=fast; -fno-math-errno, -fno-trapping-math: none
     FB_SQRT FB_SIN FB_COS FB_ATAN2 FB_FABS FB_EXP     replace libm; declare what they call before, in FLEXBEAM_CONFIG
     FB_REAL                          -        -       a class of C++11 in place of the number, with its own FB_SQRT.. and
                                                       FB_BELOW(x, y, a, b), a where x < y, else b, FB_TRUNC(x), towards
                                                       zero, FB_KERNEL(call), FB_LARGEST(call, d, A, B, n), the
                                                       call, FB_APART(f, w), f(w), FB_CARRY(memory, n),
                                                       FB_SPAN(x, n), nothing, FB_SHORTCUT(x), x or 0,
                                                       FB_LOOP(first, more, next), FB_PAIRS, a for: dual numbers, a trace
                                                       (examples/tools/trace/number.h); wants FB_ALLOW_FAST_MATH

   MEMORY of the work structs: sizeof, with the defaults above, double, 64-bit pointers; in single precision about half
     fb_rk4_work                  1728
     fb_implicit_work             9920
     fb_exponential_work          4752
     fb_system_work             684728
     fb_exact_work              206504
     fb_modes_work             3633584  (2 n + 113) n reals of n = 22 FB_MAX_ELEMENTS + 6 coordinates, an fb_modes
     fb_join_work               416520  5 n^2 reals of n = 8 FB_MAX_MODES coordinates, an fb_modes
     fb_body_work               426040
     fb_build_work             4291912  most of it an fb_modes_work
     fb_form_work                11648  FB_WITH_FORMS
     fb_analyse_work           1302584
     fb_system_analyse_work    2017752
     fb_exact_path_work         238648
     fb_exact_spectrum_work    1853192
     fb_exact_linear_work      2376344
     fb_advice_work            1156848

   CONVENTIONS
     Arguments: context (models, then the state that changes, then work), outputs, inputs, sizes. An _init has what it
     makes first. Kernels read as an assignment: fb_mat33_mul(C, A, B). A function that fills a struct ends with a verb:
     _init, _check, _step, _solve, _eval, _trim, _linearize; one that returns its number is named by it: fb_rk4_limit.
     Compile: cc -std=c99 program.c -lm. Constants of type fb_real are written FB_R(1.0), with a decimal point.
     SI units and radians. Matrices are flat and row-major, packed with the run-time n. Quaternions are (w,x,y,z), unit,
     and map body components to inertial ones. Outputs may not overlap inputs unless a function says so. Zero means
     default in a desc struct. A failing call changes nothing that it was given to change. An enum of choices
     ends with ..._COUNT, their number and no choice.

     WHAT BAD ARGUMENTS GIVE (every function, tests/checks/hostile.c; below stands only what departs from it)
     A programmer's error, FB_ASSERT(0) and then:
       a NULL pointer                            FB_ERR_NULL; an input may be NULL where that is said
       a node, axis, count that does not exist   FB_ERR_CAPACITY; below zero FB_ERR_CAPACITY or FB_ERR_VALUE
     Bad data:
       not a number, infinite, above FB_HUGE     FB_ERR_NOT_FINITE, or FB_ERR_VALUE where a range is asked for
       out of its range, no such enumerator      FB_ERR_VALUE; FB_ERR_EFFECTS, FB_ERR_STEP, FB_ERR_RANGE: see there
       what contradicts itself                   FB_ERR_SINGULAR, FB_ERR_KIND, FB_ERR_UNDETERMINED, FB_ERR_CONTRADICTION
       what is not there, or not available       FB_ERR_MODES, FB_ERR_UNREST, FB_ERR_UNSUPPORTED
       a model all zero, never initialized       FB_ERR_INIT, where states and systems of it are made and checked
     On failure no output is modified; the contents of work structs are undefined, except fields documented as set
     on failure. On FB_OK all that was written is finite.
     Functions without a status do nothing, or give 0, where a pointer is NULL or an index does not exist; numbers go
     through them as arithmetic has it. Those of >>vec3 and >>rotation, fb_lu_solve and fb_chol_solve are the innermost
     loops: pointers and sizes are taken as valid, as memcpy does. Nobody can test the sizes of the caller's arrays.
     What the library has made (beams, modes, shapes, bodies, systems, integrators) is taken as it was made; where
     memory may change by itself: fb_body_check, fb_system_check, fb_exponential_check, fb_exact_check; words that tell
     of any changed bit: fb_body_crc, fb_system_crc, fb_exact_crc.

     paper          code                     shape      unit          meaning
     m, c, J        shape.mass, .c, .J       1, 3, 3x3  kg, kg m, kg m^2   moments of mass about O
     p_a, h_a       shape.P, .H              3 x n      kg, kg m      momenta of the modes (columns)
     M_ab, K_ab     shape.M, .K              n x n      kg, N/m       elastic mass and stiffness
     upsilon_ab     shape.second.ups                n x n x 3  kg            -int psi_a x psi_b dm
     Gamma_a        shape.second.Gam                n x 3 x 3  kg m          -int psi_a^ r^ dm
     Pi_ab          shape.second.Pi                 n x n x 9  kg            -int psi_a^ psi_b^ dm
     chi_ab         (at a point)             n x n x 3  1/m           quadratic displacement u = psi q + 1/2 chi q q
     p^chi, h^chi, Gamma^chi   shape.second.pchi, .hchi, .Gamchi              their integrals
     rho, q         state.rho, .quat         3, 4       m, -          pose of the body frame
     q_a            state.q                  n          m             elastic coordinates
     pi_e           state.pi                 n          kg m/s        elastic momenta
     u, h           state.u, R^T state.L     3          m/s, N m s    velocity of the mass center; momentum about it
     v, w           motion.v, .w             3          m/s, rad/s    velocity of O and angular velocity, body axes
     Lambda, S      body terms               6 x n, 6 x 6             rigid-elastic coupling, Schur complement
     u, rho         node.displacement, .wiener_milenkovic    m, -      [L], base axes; c = 4 tan(phi/4) along the axis
     V, Omega       node.velocity, .angular_rate             m/s, rad/s  [L], of a section, its axes
     F, M           node.force, .moment                      N, N m    [L], internal loads
     gamma, kappa   element.force_strain, .moment_strain     -, 1/m    [L]
     P, H           element.momentum, .angular_momentum      kg/s, N s [L], per length
     Units of q: with mass-normalized modes (M = 1) q carries sqrt(kg) m and psi 1/sqrt(kg); only products have units.

   NOT INCLUDED (yet): plasticity, contact between bodies, fluids, fracture, warping. Joints have
   friction and stops, smoothed. Strain is linear, or with FB_EFFECT_NONLINEAR_STRAIN has the axial
   part of second degree.

   FROM WHAT YOU HOLD TO A BODY
     a beam by dimensions          fb_section_init, fb_beam_desc_add_taper, fb_beam_init
     a blade table                 fb_beam_desc.station: stiffness, mass, twist, centers; count its modes by `lowest`
     a bent boom                   fb_beam_desc.point
     how many modes?               fb_modes_desc: count, lowest, omega_limit or mass_fraction; see fb_modes.effective
     loads at known places         fb_modes_desc.load: static corrections
     air loads along a beam        fb_input.distributed: a function of the motion of its points (FB_EFFECTS_LARGE)
     bending moment, shear,        fb_body_node_loads_eval, fb_body_lines_eval (FB_EFFECTS_LARGE), fb_system_.. alike;
     tension                       at the root of a held base fb_motion.reaction_force, reaction_torque; fb_gauge_init
     an interface                  FB_BASIS_COMPONENT: constraint modes and modes with the boundary held
     several parts                 fb_modes_join, then one fb_shape_add_beam per part
     a finite-element model        fb_shape_add_lump, fb_shape_add_node, fb_shape_add_pair; shape.K
     preload, buckling             fb_modes_desc.preload, fb_buckling_solve
     a spinning, damped beam       fb_body_trim, fb_body_spectrum_solve: complex modes; fb_system_trim, ..
     A, B, C, D for a controller   fb_body_linearize, fb_system_linearize, fb_exact_linearize
     which time step?              fb_spectrum_limit, fb_spectrum_dt, fb_spectrum_error
     which effects, how many modes? fb_advice_solve from what a scene does at most, fb_advice_search by simulations
     bodies on joints at rest or   fb_system_trim, fb_system_linearize (to design a controller by),
     turning steadily              fb_system_spectrum_solve: a rotor with hinged blades, an arm, a satellite
     springs, struts between points fb_system_desc.spring; their actuators: fb_system_input.pull
     contact, airloads, feedback   fb_system_input.forces: loads, motor torques, pulls as a function of the state
     bodies on joints              fb_system_desc: a tree of joints, loops; the caller's own constraints by fb_rows
     a beam on a hinge             a clamped root with a rigid body on it (the fitting): a bare one leaves the hinge
                                   next to no inertia, but with FB_EFFECTS_LARGE, which needs none. FB_ROOT_PINNED
                                   frees the slopes of both planes: for a spherical joint, or a beam that bends in the
                                   plane of its hinge alone, both without spring, damper, friction or motor
     a beam that carries bodies    fb_modes_desc.load at that node, axes 1, 2, 4, 5: joints load it with force
                                   and moment
     what is locked or latched     fb_system_axis_set
     an IMU, a strain gauge        fb_imu_eval, fb_gauge_init
     a beam that bends far         FB_EFFECTS_LARGE: the same modes, any deflection (examples/tutorial_large.c); as the
                                   judge fb_exact_desc: curved, twisted, full 6x6 sections; steady and moving.
                                   Natural modes have no curvature at a free tip: where forces or moments act
                                   there, add fb_modes_desc.load, a few modes are then exact
     flutter, whirl, buckling      fb_exact_spectrum_solve about a steady state, fb_spectrum_margin; fb_buckling_solve
     snap-through, beyond buckling fb_exact_path_step: steady states along their path; fb_exact_work.unstable
     control of a bent beam        fb_exact_linearize: its slow modes as A, B, C, D with inputs and outputs
     hub, beams, nodes in one call fb_body_build, welds included; joints by their axes: fb_joint_desc.axis
     a model in ROM                build/flexbeam reduce: text file to C header with a static const fb_body

   WHICH INTEGRATOR? (all fixed work; a step beyond its limit is refused)
     integrator            order  limit               a step costs            takes
     fb_rk4_step           4      stiffest mode       4 evaluations           any body
     fb_midpoint_step      2      spin                3 evaluations, one LU   stiff bodies; keeps energy
     fb_sdirk_step         2      spin                5 evaluations, one LU   stiff bodies; L-stable: fast modes die out
     fb_system_rk4_step    4      stiffest mode       4 evaluations           systems; loops are closed after each step
     fb_system_sdirk_step  2      spin                6 evaluations           systems with stiff joints; L-stable
     fb_exponential_step   4      spin, light bases   4 evaluations           stiff elasticity, exactly
     fb_exact_step         2      -                   one factorization       the exact beam; keeps energy, or damps
                                                                              what is too fast for the step
     fb_stepper_step       one call for all of these: the integrator is a field of its description

   HALF AN EFFECT IS WORSE THAN NONE (the papers' equations taken apart; refused unless allow_split_effects)
     Inertia that follows the shape softens a spinning beam; without the stiffening that outweighs it a slender one
     diverges above its first bending frequency. The strain energy of third degree without that of fourth has no lower
     bound: any motion diverges, spinning or not. J(q) without its second degree makes the mass matrix indefinite. The
     stiffness torque that the paper prints for the first-order form lets energy leak where the axial strain at the root
     is free, and no refinement mends it; the one by its identity (49) does not leak, and without its third degree the
     torque no longer fits the forces (5 to 14 % off). On a basis with the same functions in every direction first- and
     second-order form are the same equations (but for rotary inertia); that basis has no axial strain at the root,
     where it is largest.

   AXIAL STRAIN: call sequence for nonlinear axial strain. fb_modes_solve with basis FB_BASIS_FUNCTIONS, count
     FB_ALL_MODES for bend_y, bend_z and axial, root_strain 1; fb_shape_add_beam, then fb_shape_add_beam_strain, once
     per beam; effects FB_EFFECTS_STRAIN. One cubic element in space has 6 coordinates, root_strain adds one: set
     FB_MAX_MODES. Use an implicit or exponential integrator (axial modes are too stiff for fb_rk4_step).

   REFERENCES (derivations by id: tests/reference/THEORY.md; misprints of the papers: tests/reference/ERRATA.md)
     [DB] G.M.T. D'Eleuterio and T.D. Barfoot, "Just a second, we'd like to go first: a first-order discretized
          formulation for structural dynamics".
     [H]  A.S. Hopkins, "The motion of interconnected flexible bodies", 1975.
     [L]  Leigh, "The application of Hamilton's weak principle", thesis, 2006.
     [MN] R. MacNeal, "A simple quadrilateral shell element", Computers and Structures 8, 1978.
     [AL] R. Alexander, "Diagonally implicit Runge-Kutta methods for stiff O.D.E.'s", SIAM J. Numer. Anal. 14, 1977.
     [KR] S. Krogstad, "Generalized integrating factor methods for stiff PDEs", J. Comput. Phys. 203, 2005.
     [HW] E. Hairer and G. Wanner, "Solving Ordinary Differential Equations II", Springer, IV.2 (stability region).
     [FE] R. Featherstone, "Rigid Body Dynamics Algorithms", Springer, 2008.
     [GV] G.H. Golub and C.F. Van Loan, "Matrix Computations". */
#ifndef FLEXBEAM_H
#define FLEXBEAM_H

/* ---------------------------------------------------------------------------------------------------------------
   RUN >>config */

#ifdef FLEXBEAM_CONFIG
#include FLEXBEAM_CONFIG
#endif

#ifndef FB_SINGLE
#define FB_SINGLE 0
#endif
#ifndef FB_MAX_MODES
#define FB_MAX_MODES 12
#endif
#ifndef FB_MAX_NODES
#define FB_MAX_NODES 8
#endif
#ifndef FB_MAX_LOADS
#define FB_MAX_LOADS 8
#endif
#ifndef FB_MAX_ELEMENTS
#define FB_MAX_ELEMENTS 20
#endif
#ifndef FB_MAX_STATIONS
#define FB_MAX_STATIONS 64
#endif
#ifndef FB_MAX_LUMPS
#define FB_MAX_LUMPS 8
#endif
#ifndef FB_MAX_BODIES
#define FB_MAX_BODIES 8
#endif
#ifndef FB_MAX_LOOPS
#define FB_MAX_LOOPS 4
#endif
#ifndef FB_MAX_SPRINGS
#define FB_MAX_SPRINGS 4
#endif
#ifndef FB_MAX_ROWS
#define FB_MAX_ROWS 24
#endif
#ifndef FB_MAX_SPEEDS
#define FB_MAX_SPEEDS 64
#endif
#ifndef FB_MAX_PORTS
#define FB_MAX_PORTS 12
#endif
#ifndef FB_MAX_EXACT
#define FB_MAX_EXACT 40
#endif
#ifndef FB_WITH_SPIN_COUPLING
#define FB_WITH_SPIN_COUPLING 1
#endif
#ifndef FB_WITH_RESIDUAL_INERTIA
#define FB_WITH_RESIDUAL_INERTIA 1
#endif
#ifndef FB_WITH_SPIN_STIFFENING
#define FB_WITH_SPIN_STIFFENING 1
#endif
#ifndef FB_WITH_ACCELERATION_STIFFENING
#define FB_WITH_ACCELERATION_STIFFENING 1
#endif
#ifndef FB_WITH_DAMPING
#define FB_WITH_DAMPING 1
#endif
#ifndef FB_WITH_GRAVITY
#define FB_WITH_GRAVITY 1
#endif
#ifndef FB_WITH_OPTIONAL
#define FB_WITH_OPTIONAL 1
#endif
#ifndef FB_WITH_NONLINEAR_STRAIN
#define FB_WITH_NONLINEAR_STRAIN FB_WITH_OPTIONAL
#endif
#ifndef FB_WITH_LARGE_DEFLECTION
#define FB_WITH_LARGE_DEFLECTION FB_WITH_OPTIONAL
#endif
#ifndef FB_WITH_ROTORS
#define FB_WITH_ROTORS FB_WITH_OPTIONAL
#endif
#ifndef FB_MAX_ROTORS
#define FB_MAX_ROTORS 4
#endif
#ifndef FB_MAX_POINTS
#define FB_MAX_POINTS 32
#endif
#ifndef FB_MAX_LINES
#define FB_MAX_LINES 8
#endif
#ifndef FB_MAX_LINE_ROWS
#define FB_MAX_LINE_ROWS 0
#endif
#ifndef FB_MAX_LINE_TABLE
#define FB_MAX_LINE_TABLE 0
#endif
#ifndef FB_MAX_STRAINS
#define FB_MAX_STRAINS 24
#endif
#ifndef FB_MAX_LAMBDA
#define FB_MAX_LAMBDA 0
#endif
#ifndef FB_MAX_S
#define FB_MAX_S 0
#endif
#ifndef FB_WITH_FORMS
#define FB_WITH_FORMS 0
#endif
#ifndef FB_WITH_SYSTEM
#define FB_WITH_SYSTEM 1
#endif
#ifndef FB_WITH_EXACT
#define FB_WITH_EXACT 1
#endif
#ifndef FB_WITH_BUILD
#define FB_WITH_BUILD 1
#endif
#ifndef FB_WITH_ANALYSE
#define FB_WITH_ANALYSE FB_WITH_BUILD
#endif
#ifndef FB_WITH_DETAIL
#define FB_WITH_DETAIL 0
#endif
#ifndef FB_ASSERT
#define FB_ASSERT(x) ((void)0)
#endif

#if FB_SINGLE != 0 && FB_SINGLE != 1
#error "flexbeam: FB_SINGLE is 0 or 1"
#endif
#if FB_MAX_MODES < 1 || FB_MAX_MODES > 60
#error "flexbeam: FB_MAX_MODES is 1..60"
#endif
#if FB_MAX_NODES < 1 || FB_MAX_NODES > 255 || FB_MAX_LOADS < 1 || FB_MAX_LOADS > 255
#error "flexbeam: FB_MAX_NODES and FB_MAX_LOADS are 1..255"
#endif
#if FB_MAX_ELEMENTS < 1 || FB_MAX_ELEMENTS > 200 || FB_MAX_STATIONS < 1 || FB_MAX_STATIONS > 999 || \
    FB_MAX_LUMPS < 1 || FB_MAX_LUMPS > 255
#error "flexbeam: FB_MAX_ELEMENTS is 1..200, FB_MAX_STATIONS 1..999, FB_MAX_LUMPS 1..255"
#endif
#if FB_MAX_BODIES < 1 || FB_MAX_BODIES > 99 || FB_MAX_LOOPS < 1 || FB_MAX_LOOPS > 99 || FB_MAX_ROWS < 1 || \
    FB_MAX_ROWS > 999 || FB_MAX_SPEEDS < 6 || FB_MAX_SPEEDS > 999
#error "flexbeam: FB_MAX_BODIES and FB_MAX_LOOPS are 1..99, FB_MAX_ROWS 1..999, FB_MAX_SPEEDS 6..999"
#endif
#if FB_MAX_SPRINGS < 1 || FB_MAX_SPRINGS > 99 || FB_MAX_PORTS < 1 || FB_MAX_PORTS > 255
#error "flexbeam: FB_MAX_SPRINGS is 1..99, FB_MAX_PORTS 1..255"
#endif
#if FB_MAX_EXACT < 1 || FB_MAX_EXACT > 999
#error "flexbeam: FB_MAX_EXACT is 1..999"
#endif
#if (FB_WITH_SPIN_COUPLING | FB_WITH_RESIDUAL_INERTIA | FB_WITH_SPIN_STIFFENING | FB_WITH_ACCELERATION_STIFFENING | \
     FB_WITH_DAMPING | FB_WITH_GRAVITY | FB_WITH_NONLINEAR_STRAIN | FB_WITH_LARGE_DEFLECTION | FB_WITH_ROTORS |     \
     FB_WITH_OPTIONAL | FB_WITH_FORMS | FB_WITH_SYSTEM | FB_WITH_EXACT | FB_WITH_BUILD | FB_WITH_ANALYSE) > 1
#error "flexbeam: FB_WITH_... are 0 or 1"
#endif
#if FB_WITH_DETAIL != 0 && FB_WITH_DETAIL != 1
#error "flexbeam: FB_WITH_DETAIL is 0 or 1"
#endif
#if FB_WITH_ANALYSE && !FB_WITH_BUILD
#error "flexbeam: FB_WITH_ANALYSE needs FB_WITH_BUILD"
#endif
#if FB_MAX_ROTORS < 1 || FB_MAX_ROTORS > 99
#error "flexbeam: FB_MAX_ROTORS is 1..99"
#endif
#if FB_MAX_POINTS < 2 || FB_MAX_POINTS > 998 || FB_MAX_POINTS % 2
#error "flexbeam: FB_MAX_POINTS is 2..998, even"
#endif
#if FB_MAX_LINES < 1 || FB_MAX_LINES > 99
#error "flexbeam: FB_MAX_LINES is 1..99"
#endif
#if FB_MAX_LINE_ROWS < 0 || FB_MAX_LINE_ROWS > 60000 || FB_MAX_LINE_TABLE < 0 || FB_MAX_LINE_TABLE > 9999999
#error "flexbeam: FB_MAX_LINE_ROWS is 0..60000, FB_MAX_LINE_TABLE 0..9999999"
#endif
#if FB_MAX_STRAINS < 1 || FB_MAX_STRAINS > 999
#error "flexbeam: FB_MAX_STRAINS is 1..999"
#endif
#if FB_MAX_LAMBDA < 0 || FB_MAX_LAMBDA > 60000 || FB_MAX_S < 0 || FB_MAX_S > 60000
#error "flexbeam: FB_MAX_LAMBDA and FB_MAX_S are 0..60000"
#endif
#if FB_WITH_FORMS && !(FB_WITH_SPIN_COUPLING && FB_WITH_RESIDUAL_INERTIA && FB_WITH_NONLINEAR_STRAIN && FB_WITH_BUILD)
#error "flexbeam: FB_WITH_FORMS needs FB_WITH_SPIN_COUPLING, _RESIDUAL_INERTIA, _NONLINEAR_STRAIN and _BUILD"
#endif
#ifndef FB_ALLOW_FAST_MATH
#if defined(__FAST_MATH__) || defined(_M_FP_FAST)
#error "flexbeam: -ffast-math voids the finite checks; define FB_ALLOW_FAST_MATH to accept that"
#elif defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ + 0
#error "flexbeam: -ffinite-math-only voids the finite checks; define FB_ALLOW_FAST_MATH to accept that"
#elif defined(__ASSOCIATIVE_MATH__)
#error "flexbeam: -fassociative-math voids the compensated sums; define FB_ALLOW_FAST_MATH to accept that"
#endif
#endif

#ifdef FB_REAL /* a class of C++ in place of a number, which knows its derivatives, or how it was made */
typedef FB_REAL fb_real;
#define FB_R(x) fb_real(x)
#elif FB_SINGLE
typedef float fb_real;
#define FB_R(x) (x##f)
#else
typedef double fb_real;
#define FB_R(x) (x)
#endif
#if FB_SINGLE
#define FB_EPSILON 1.19209290e-7f
#define FB_HUGE 1e18f  /* magnitudes above this are refused: their squares overflow */
#define FB_TINY 1e-12f /* magnitudes below this become zero in a step: their cubes underflow */
#else
#define FB_EPSILON 2.2204460492503131e-16
#define FB_HUGE 1e150
#define FB_TINY 1e-100
#endif

#ifdef FLEXBEAM_STATIC
#ifndef FLEXBEAM_IMPLEMENTATION
#define FLEXBEAM_IMPLEMENTATION
#endif
#if defined(__GNUC__)
#define FB_API static __attribute__((unused))
#else
#define FB_API static
#endif
#elif defined(__cplusplus)
#define FB_API extern "C"
#else
#define FB_API extern
#endif

/* The configuration is the name of a symbol that every including file refers to and the implementation defines:
   files that disagree do not link ("undefined reference to fb_config_is_double_modes12..."). */
#if FB_SINGLE
#define FBI_PRECISION single
#else
#define FBI_PRECISION double
#endif
#define FBI_CAT(p, m, n, l, e, s, u, t, v, w, i, j, k, r, x, a, b, c, d, f, g, h, A, B, C, D, E, F, G, H, J, K, L, M, \
                N)                                                                                                    \
  fb_config_is_##p##_modes##m##_nodes##n##_loads##l##_elements##e##_stations##s##_lumps##u##_strains##t##_lambda##v##_s##w##_bodies##i##_loops##j##_springs##K##_rows##k##_speeds##r##_ports##N##_exact##x##_points##F##_lines##G##_linerows##H##_linetable##J##_rotors##L##_with##a##b##c##d##f##g##h##E##M##_rooms##A##B##C##D
#define FBI_CAT_(p, m, n, l, e, s, u, t, v, w, i, j, k, r, x, a, b, c, d, f, g, h, A, B, C, D, E, F, G, H, J, K, L, M, \
                 N)                                                                                                    \
  FBI_CAT(p, m, n, l, e, s, u, t, v, w, i, j, k, r, x, a, b, c, d, f, g, h, A, B, C, D, E, F, G, H, J, K, L, M, N)
#define FBI_CONFIG_SYMBOL                                                                                           \
  FBI_CAT_(FBI_PRECISION, FB_MAX_MODES, FB_MAX_NODES, FB_MAX_LOADS, FB_MAX_ELEMENTS, FB_MAX_STATIONS, FB_MAX_LUMPS, \
           FB_MAX_STRAINS, FB_MAX_LAMBDA, FB_MAX_S, FB_MAX_BODIES, FB_MAX_LOOPS, FB_MAX_ROWS, FB_MAX_SPEEDS,        \
           FB_MAX_EXACT, FB_WITH_SPIN_COUPLING, FB_WITH_RESIDUAL_INERTIA, FB_WITH_SPIN_STIFFENING,                  \
           FB_WITH_ACCELERATION_STIFFENING, FB_WITH_DAMPING, FB_WITH_GRAVITY, FB_WITH_NONLINEAR_STRAIN,             \
           FB_WITH_SYSTEM, FB_WITH_EXACT, FB_WITH_BUILD, FB_WITH_ANALYSE, FB_WITH_LARGE_DEFLECTION, FB_MAX_POINTS,  \
           FB_MAX_LINES, FB_MAX_LINE_ROWS, FB_MAX_LINE_TABLE, FB_MAX_SPRINGS, FB_MAX_ROTORS, FB_WITH_ROTORS,        \
           FB_MAX_PORTS)
#define FBI_STRING(x) #x
#define FBI_STRING_(x) FBI_STRING(x)

#ifndef FLEXBEAM_STATIC
#ifdef __cplusplus
extern "C" {
#endif
extern const char FBI_CONFIG_SYMBOL[];
#ifdef __cplusplus
}
#endif
#if defined(__ELF__) && defined(__GNUC__) /* from a note: it is not loaded, and --gc-sections keeps what it names */
#if __SIZEOF_POINTER__ == 8
#define FBI_NOTE(symbol) "8, 1\n.asciz \"flexbeam\"\n.balign 4\n.8byte " symbol
#else
#define FBI_NOTE(symbol) "4, 1\n.asciz \"flexbeam\"\n.balign 4\n.4byte " symbol
#endif
__asm__(".pushsection .note.flexbeam,\"\",%note\n.balign 4\n.4byte 9, " FBI_NOTE(
    FBI_STRING_(FBI_CONFIG_SYMBOL)) "\n.popsection");
#else
static const char *const fbi_config_reference = FBI_CONFIG_SYMBOL;
#endif
#endif

/* Before a variable: each thread has its own. */
#if defined(__cplusplus)
#define FBI_THREAD thread_local
#elif defined(__GNUC__)
#define FBI_THREAD __thread
#elif defined(_MSC_VER)
#define FBI_THREAD __declspec(thread)
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define FBI_THREAD _Thread_local
#else
#define FBI_THREAD
#endif

/* Capacities that follow from the options. */
#define FBI_WITH_QUADRATIC (FB_WITH_SPIN_STIFFENING || FB_WITH_ACCELERATION_STIFFENING)
#define FBI_WITH_SHAPE_INERTIA (FB_WITH_RESIDUAL_INERTIA || FBI_WITH_QUADRATIC)
#define FBI_MAX_PAIRS (FB_MAX_MODES * (FB_MAX_MODES + 1) / 2)
#define FBI_MAX_COORDINATES (FB_MAX_MODES + FB_WITH_ROTORS * FB_MAX_ROTORS) /* of a body: modes, then rotors */
#define FBI_MAX_STRAINS ((FB_MAX_STRAINS + 3) / 4 * 4)                      /* whole groups of four */
#define FBI_EXPONENTIAL_STRAINS (FB_WITH_NONLINEAR_STRAIN ? FBI_MAX_STRAINS : 1)
#define FBI_MAX_DOF (6 * (FB_MAX_ELEMENTS + 1) + 16 * FB_MAX_ELEMENTS)
#define FBI_MAX_ROW (3 * 6 + 2 * 16) /* of K and M of a beam */

/* ---------------------------------------------------------------------------------------------------------------
   RUN >>status */

#define FB_STATUS_LIST(X)                                                                                            \
  X(FB_OK, 0, "ok")                                                                                                  \
  X(FB_ERR_NULL, -1, "a required pointer is NULL")                                                                   \
  X(FB_ERR_VALUE, -2, "a value is out of its range")                                                                 \
  X(FB_ERR_NOT_FINITE, -3, "a value is not finite, or so large that its square is not")                              \
  X(FB_ERR_CAPACITY, -4, "more than the compile-time capacity, or an index beyond what exists")                      \
  X(FB_ERR_SINGULAR, -5, "a matrix is singular or not positive definite: no mass, inertia or stiffness, or buckled") \
  X(FB_ERR_CONVERGENCE, -6, "the iteration did not converge")                                                        \
  X(FB_ERR_KIND, -7, "a kind of deformation has no stiffness or no inertia there")                                   \
  X(FB_ERR_EFFECTS, -8,                                                                                              \
    "effects are split, excluded, removed at compile time or lack data; zeta or gravity lacks its effect")           \
  X(FB_ERR_STEP, -9, "the step is longer than the stability limit of the integrator")                                \
  X(FB_ERR_RANGE, -10, "the deflection has left the range of the model")                                             \
  X(FB_ERR_UNDETERMINED, -11, "a joint or a mode moves no inertia: the acceleration is not determined")              \
  X(FB_ERR_CONTRADICTION, -12, "constraints contradict each other, or a loop cannot be closed")                      \
  X(FB_ERR_BUILD, -13,                                                                                               \
    "built with -fassociative-math, -funsafe-math-optimizations or without NaN: see fb_build_check")                 \
  X(FB_ERR_MODES, -14, "fewer modes than asked for")                                                                 \
  X(FB_ERR_UNREST, -15, "no steady state: loads or gravity push what nothing holds, or a prescribed axis moves on")  \
  X(FB_ERR_UNSUPPORTED, -16, "not available for this model: see the comment on the function")                        \
  X(FB_ERR_INIT, -17, "a body, system or exact beam that was never initialized: its fb_..._init did not run, or failed")

#define FBI_STATUS_ENUM(name, value, text) name = (value),
typedef enum fb_status { FB_STATUS_LIST(FBI_STATUS_ENUM) } fb_status;
#undef FBI_STATUS_ENUM

/* Text of a status; never NULL. */
FB_API const char *fb_status_string(fb_status status);

#if FB_WITH_DETAIL
/* What was refused, why, and by how much. */
typedef struct fb_detail {
  fb_status status;
  const char *function; /* the public function that refused; one that another of the library called has its own name */
  const char *what;   /* field or argument, unit, relation wanted: "dt [s] at this spin [rad/s], at most"; with an index
                           first what it counts: "station: EI_y [N m^2], at least" */
  int index;          /* of the station, mode, joint, body, node, load, ..; -1: none */
  fb_real have, need; /* the value found and the bound; 0, 0: `what` says all */
  fb_real at;         /* a further number that `what` names: the spin; of a field of several numbers: which, from 0 */
  int part;           /* of fb_build_desc, where fb_body_build called the function; -1: none */
} fb_detail;

/* This thread's last refusal of data or argument that has a record; never NULL. At first FB_OK with empty texts; no
   success clears it, and a refusal without a record leaves it: look at it after a failure, if its status is that which
   was returned. Threads have their own where the compiler has thread-local storage (C11, C++11, gcc, clang, MSVC). */
FB_API const fb_detail *fb_detail_last(void);
#endif

/* ---------------------------------------------------------------------------------------------------------------
   RUN >>vec3: sizes are fixed; outputs may not overlap inputs unless said */

FB_API fb_real fb_vec3_dot(const fb_real a[3], const fb_real b[3]);
FB_API void fb_vec3_cross(fb_real c[3], const fb_real a[3], const fb_real b[3]);      /* c = a x b */
FB_API void fb_mat33_mul_vec3(fb_real y[3], const fb_real A[9], const fb_real x[3]);  /* y = A x */
FB_API void fb_mat33_mulT_vec3(fb_real y[3], const fb_real A[9], const fb_real x[3]); /* y = A^T x */
FB_API void fb_mat33_mul(fb_real C[9], const fb_real A[9], const fb_real B[9]);       /* C = A B */

/* Symmetric 6x6 matrices are packed by the upper triangle in 21 numbers, fb_sym6_index(i, j) with any order of i, j (0
   where one is not 0..5). */
FB_API int fb_sym6_index(int i, int j);
FB_API void fb_sym6_mul_vec6(fb_real y[6], const fb_real S[21], const fb_real x[6]); /* y = S x */
/* x = S^-1 y for positive definite S; x may be y. FB_ERR_SINGULAR: S is not positive definite; FB_ERR_NOT_FINITE. */
FB_API fb_status fb_sym6_solve(fb_real x[6], const fb_real S[21], const fb_real y[6]);

/* ---------------------------------------------------------------------------------------------------------------
   RUN >>rotation: quaternions (w,x,y,z); rotation vectors [rad] */

FB_API void fb_quat_mul(fb_real r[4], const fb_real p[4], const fb_real q[4]); /* r = p o q */
FB_API void fb_quat_to_mat33(fb_real R[9], const fb_real q[4]);                /* x_I = R x_B */
FB_API void fb_quat_from_rotvec(fb_real q[4], const fb_real phi[3]);           /* exponential */
FB_API void fb_quat_to_rotvec(fb_real phi[3], const fb_real q[4]);             /* logarithm, |phi| <= pi */
/* Wiener-Milenkovic parameters 4 tan(phi/4) along the axis, phi within half a turn: |c| <= 4. */
FB_API void fb_quat_to_wiener_milenkovic(fb_real c[3], const fb_real q[4]);
FB_API void fb_quat_from_wiener_milenkovic(fb_real q[4], const fb_real c[3]);
/* Pose r, q reached by the constant twist x = (displacement, rotation) in its own axes, and back (rotation <= pi). */
FB_API void fb_pose_from_twist(fb_real r[3], fb_real q[4], const fb_real x[6]);
FB_API void fb_pose_to_twist(fb_real x[6], const fb_real r[3], const fb_real q[4]);
/* Scales q to unit length in place. FB_ERR_VALUE: zero or not finite; q unchanged. */
FB_API fb_status fb_quat_normalize(fb_real q[4]);

/* ---------------------------------------------------------------------------------------------------------------
   RUN >>solve: dense, run-time n; singularity is judged relative to each row and column, so scaling units changes
   nothing */

/* A (n x n) is overwritten by its factors P A = L U. FB_ERR_SINGULAR, FB_ERR_NOT_FINITE: A is spoiled.
   scale: n reals of scratch. */
FB_API fb_status fb_lu_factor(fb_real *A, int *perm, fb_real *scale, int n);
/* x = A^-1 b with the factors; x may not be b. */
FB_API void fb_lu_solve(fb_real *x, const fb_real *LU, const int *perm, const fb_real *b, int n);

/* The lower triangle of the symmetric A (n x n) is overwritten by L, A = L L^T. FB_ERR_SINGULAR: not positive
   definite. */
FB_API fb_status fb_chol_factor(fb_real *A, int n);
FB_API void fb_chol_solve(fb_real *x, const fb_real *L, const fb_real *b, int n); /* x = A^-1 b; x may be b */

#if FB_WITH_LARGE_DEFLECTION
/* ---------------------------------------------------------------------------------------------------------------
   RUN >>line: geometrically exact lines, the beams of a body whose modes are read as modes of curvature
   (FB_EFFECT_LARGE_DEFLECTION). Along the reference line, H the rotation of a section, e and H e its tangent undeformed
   and deformed, theta_a the rotation and Gamma_a the stretch and shear of mode a:

     H' = H (sum theta_a' q_a)^      r = r_root + int H (e + sum Gamma_a q_a) dx

   Nothing is truncated: kinetic energy follows from these fields at points along the line, strain energy is
   1/2 q^T K q, quadratic in the curvatures. Points are those of Gauss-Lobatto quadrature on each smooth stretch; from
   point to point H turns by the rotation vector A q - 1/6 A q x B q, A and B from the rotations of the modes there and
   their mean between the points. */

#if FB_MAX_LINE_ROWS > 0
#define FBI_MAX_LINE_ROWS FB_MAX_LINE_ROWS
#else
#define FBI_MAX_LINE_ROWS (6 * FB_MAX_MODES * FB_MAX_LINES)
#endif
#if FB_MAX_LINE_TABLE > 0
#define FBI_MAX_LINE_TABLE FB_MAX_LINE_TABLE
#else
#define FBI_MAX_LINE_TABLE \
  (9 * FB_MAX_MODES * FB_MAX_POINTS + 2 * FB_MAX_POINTS * (FB_MAX_POINTS + 2) + 3 * FB_MAX_MODES * FB_MAX_LINES)
#endif

typedef struct fb_line_row { /* what coordinate a of a line adds about or along an axis at all of its points */
  unsigned short axis, a;
  int at; /* turns: A, then B; stretches: Gamma; from table[at] on */
} fb_line_row;

typedef struct fb_line {
  unsigned short first, n; /* coordinates that deform it */
  unsigned short point, count,
      stride; /* first point, number of points, that rounded up to even: rows have this length */
  unsigned short row, n_turn, n_stretch; /* rows: turns by coordinate, then stretches by coordinate */
  int weight; /* table: what each point's tangent adds to the position of every point, count x stride; behind it for
                 sums over the masses (count + 4) x stride */
  int shift;  /* table, n x 3: displacement of a root that moves with the modes; moves = 0: none */
  unsigned short moves;
  unsigned short hangs;      /* 1 + the point of an earlier line that the root moves with; 0: the body frame */
  unsigned short carries;    /* 1: others hang on it */
  unsigned short solid;      /* 1: points have offset mass centers or rotary inertia */
  int plane;                 /* 1 + the axis about which all of its coordinates turn it (fbi_line_plane); 0: none */
  int turned;                /* 1: the line's axes are not the body's */
  fb_real axes[9];           /* line axes to body axes */
  fb_real root[3], frame[9]; /* [m] root, beam axes to body axes: by which init finds a beam's line */
} fb_line;

/* Loads and internal loads by points: those of each line in its order, before them its root where that is at rest. */
#define FB_MAX_LINE_POINTS (FB_MAX_POINTS + FB_MAX_LINES)
#define FBI_MAX_LINE_SIDES (FB_MAX_POINTS / 2 + FB_MAX_LINES)

typedef struct fb_line_station { /* where a point, or a root at rest, stands */
  fb_real x, length, before;     /* [m] from the root; of the line, by the quadrature, and the part before the point */
  fb_real axes[9];               /* section axes, undeformed, to line axes */
  unsigned short side; /* 1 + its number in `side`; 0: within a stretch, mass and load are alike on both sides */
} fb_line_station;

typedef struct fb_line_side { /* mass of the sections before and behind an end of a stretch, without lumped bodies */
  fb_real mass[2], first[2][3], moment[2][6]; /* about the point, line axes: sum of m, m d, inertia as above */
} fb_line_side;

typedef struct fb_lines {
  int n_line, n_point, n_row, n_table; /* used; n_point is even */
  int n_side;
  fb_line line[FB_MAX_LINES];
  fb_real mass[FB_MAX_POINTS];                                /* [kg] */
  fb_real center[3 * FB_MAX_POINTS];                          /* [m] mass center from the line, line axes */
  fb_real inertia[6 * FB_MAX_POINTS];                         /* [kg m^2] about it, packed: xx, xy, xz, yy, yz, zz */
  fb_real start[3][FB_MAX_POINTS], tangent[3][FB_MAX_POINTS]; /* r = start + sum of weight t; e; line axes */
  fb_line_station station[FB_MAX_POINTS], root[FB_MAX_LINES]; /* by point, by line (length 0: the root is a point) */
  fb_line_side side[FBI_MAX_LINE_SIDES];
  fb_line_row row[FBI_MAX_LINE_ROWS];
  fb_real table[FBI_MAX_LINE_TABLE];
} fb_lines;

/* A point of the lines, inertial axes. Section axes: x along the line, y and z the principal axes of the section. */
typedef struct fb_line_point {
  int body;                             /* of a system: its number; 0: a single body */
  int line;                             /* number of the beam, in the order of fb_shape_add_beam */
  fb_real x;                            /* [m] along the line from its root, undeformed */
  fb_real length;                       /* [m] of the line that the point stands for; their sum is its length */
  fb_real position[3], R[9];            /* [m] of the line; section to inertial axes */
  fb_real velocity[3], angular_rate[3]; /* [m/s], [rad/s] of the section at the line */
  fb_real force[3], torque[3];          /* [N], [N m] what acts there, at the line: force per length times
                                                     `length` */
} fb_line_point;

/* Distributed loads at time t: writes force and torque of all n points of a body, zero before. Called once an
   evaluation, of a system for each body with lines; several times a step, at attempts, too: keep no history in it.
   Points are the roots and the quadrature nodes, by lines from the root on. A load that is smooth along the line is
   integrated as accurately as a polynomial through them times the modes; one that jumps where no stretch ends (lumped
   body, kink, step of the sections) less so. Loads that grow with the velocity are not part of the step limit.
   A status other than FB_OK ends the call, and so does a number that is not finite (FB_ERR_NOT_FINITE). */
typedef fb_status (*fb_distributed)(fb_line_point *point, int n, fb_real t, void *user);

typedef struct fb_line_node {              /* a node on a line, line axes */
  int line;                                /* 1 + its number; 0: none, the node is described by its shapes */
  int after;                               /* 1 + the point before it; 0: the root */
  fb_real start[3], weight[FB_MAX_POINTS]; /* r = start + sum of weight t */
  fb_real turn[3 * FB_MAX_MODES], bow[3 * FB_MAX_MODES]; /* A, B of the interval from that point, n x 3 */
  fb_real x, axes[9];                                    /* [m] from the root; section axes, undeformed, to line axes */
} fb_line_node;

#endif

/* ---------------------------------------------------------------------------------------------------------------
   RUN >>body: one body in a floating frame */

/* Switches, or-ed into a mask. The degrees are those of the elastic coordinates in the inertia. */
typedef enum fb_effect {
  FB_EFFECT_ELASTIC = 1,                  /* the modes move; without it the body is rigid */
  FB_EFFECT_SPIN_COUPLING = 2,            /* gyroscopic (Coriolis) coupling of modes, N(w): degree 1 */
  FB_EFFECT_RESIDUAL_INERTIA = 4,         /* inertia follows the shape, centrifugal softening: degrees 1, 2 */
  FB_EFFECT_SPIN_STIFFENING = 8,          /* centrifugal stiffening by foreshortening: degree 2 */
  FB_EFFECT_ACCELERATION_STIFFENING = 16, /* the same by acceleration of O, angular acceleration, gravity */
  FB_EFFECT_DAMPING = 32,                 /* modal damping */
  FB_EFFECT_GRAVITY = 64,                 /* uniform gravity */
  FB_EFFECT_NONLINEAR_STRAIN = 128, /* axial strain u_x' + 1/2 (u_y'^2 + u_z'^2): stiffening by axial coordinates */
  FB_EFFECT_LARGE_DEFLECTION = 256, /* beams bend and twist by any angle: their modes are modes of curvature (>>line) */
  FB_EFFECT_ROTORS = 512,           /* wheels turn inside; fb_body_init sets it where fb_body_desc has any */
  FB_EFFECT_CENTRAL_GRAVITY = 1024  /* gravity of a center; fb_body_init sets it where mu of fb_body_desc is above 0 */
} fb_effect;
#define FB_EFFECTS_RIGID 0u
#define FB_EFFECTS_LINEAR 1u   /* level 1 of the accuracy ladder */
#define FB_EFFECTS_SPIN 3u     /* level 2 */
#define FB_EFFECTS_FULL 31u    /* level 3: every inertial effect; add damping and gravity as called for */
#define FB_EFFECTS_LARGE 287u  /* level 4: geometrically exact beams, any deflection */
#define FB_EFFECTS_STRAIN 135u /* stiffening by axial coordinates instead of the quadratic field, beside level 3 */

/* FB_ERR_EFFECTS: an effect was removed at compile time, or the set is one of HALF AN EFFECT IS WORSE THAN NONE:
     residual inertia without spin coupling, or without the spin stiffening (or nonlinear strain) that outweighs it;
     nonlinear strain with spin or acceleration stiffening: the foreshortening would count twice;
     large deflection without all of FB_EFFECTS_FULL, which the parts that are no beams need.
   fb_body_init also refuses spin stiffening of a FREE body without acceleration stiffening: it would depend on O.
   Sets without residual inertia are for bodies that turn slowly, in a system for those whose O moves slowly, too: loads
   on the modes by products of w, and by w x v of O, are missing. With them every integrator is of order 1 on a
   prescribed base that turns while its v changes. */
FB_API fb_status fb_effects_check(unsigned effects);

/* A point of a body that carries loads or is looked at. Node 0 is the origin O of the body frame. */
typedef struct fb_node {
  fb_real r[3];                    /* [m] undeformed position */
  fb_real psi[3 * FB_MAX_MODES];   /* n x 3 displacement shapes */
  fb_real theta[3 * FB_MAX_MODES]; /* n x 3 rotation shapes */
#if FBI_WITH_QUADRATIC
  fb_real chi[3 * FBI_MAX_PAIRS];       /* pairs a >= b at a (a+1)/2 + b: quadratic displacement */
  fb_real chi_theta[3 * FBI_MAX_PAIRS]; /* quadratic rotation */
#endif
#if FB_WITH_LARGE_DEFLECTION
  fb_line_node line; /* with that effect, in place of the shapes */
#endif
} fb_node;

typedef struct fb_gauge { /* a strain gauge: what each coordinate of a body adds to its reading */
  int n;
  fb_real gain[FB_MAX_MODES];
} fb_gauge;
/* Strain [-], linear in q; with lines of large deflection exact for any: coordinates are those of curvature. */
FB_API fb_real fb_gauge_eval(const fb_gauge *gauge, const fb_real *q);

#if FB_WITH_ROTORS
/* A rotor: a wheel inside a body, whose speed about its own axis is its only freedom: reaction wheel, gyro, flywheel,
   turbine (a gyrostat). Bodies of systems have them, too: started by fb_link_motion, driven by fb_system_input.
     Momentum   inertia (rate of the node about the axis + speed), behind the momenta of the modes in fb_state.pi. One
                that is given follows the input whatever torque that takes; the torque of the input, its rate, then
                matters to accelerations and reactions alone.
     Inertia    the mass and inertia that the caller gives to hub or lumped bodies have the rotor's mass and its inertia
                across the axis, but NOT that about the axis. Of a craft measured with its wheels locked subtract
                inertia axis axis^T of each.
     Step       its speed shortens no step; the nutation that its momentum causes does. The spin of the body itself
                counts in every limit: a fast top or a spun stage is better a rotor on a body that does not spin. A
                wheel that is a body on a hinge costs more and bounds the step by its speed.
     Imbalance  (jitter) a force and a torque that turn with the rotor, of their size at constant speed. They are loads
                on the body, do not brake the rotor, and have no harmonics and no resonances of the wheel. A step has to
                resolve the rotation.
   Internal loads of lines are known with rotors on the hub alone, otherwise FB_ERR_UNSUPPORTED. */
typedef struct fb_rotor {
  int node;        /* on whose section it sits; 0: on the body frame. On other nodes the modes turn its axis */
  int given;       /* 1: its momentum is that of the input; 0: it follows from the torques */
  fb_real axis[3]; /* body axes, of the undeformed body; fb_body_init makes it a unit vector */
  fb_real inertia; /* [kg m^2] about the axis, above 0 */
  /* friction torque -(damping speed + friction speed/sqrt(speed^2 + friction_speed^2)): viscous, and Coulomb friction
     that goes through zero with a slope */
  fb_real damping, friction, friction_speed; /* [N m s], [N m], [rad/s] above 0 with friction */
  fb_real static_imbalance;                  /* [kg m] force static_imbalance spin^2 along x (angle) */
  fb_real dynamic_imbalance; /* [kg m^2] torque dynamic_imbalance spin^2 along x (angle + dynamic_phase) */
  fb_real dynamic_phase;     /* [rad] */
  /* set by fb_body_init: */
  int moves;         /* modes move the node */
  fb_real across[3]; /* x at angle 0 */
  fb_real mobility;  /* [1/(kg m^2)] of the body across the axis, largest: nutation is at most momentum times it */
  fb_real rate;      /* [1/s] by which friction brakes at most */
} fb_rotor;

typedef struct fb_rotor_input {
  fb_real torque;   /* [N m] of the motor on the rotor, and reversed on the body; given: the rate of its momentum */
  fb_real momentum; /* [N m s] of a rotor whose momentum is given; else 0 */
} fb_rotor_input;
#endif

/* How the body frame moves. */
typedef enum fb_base {
  FB_BASE_FREE = 0,
  FB_BASE_PRESCRIBED = 1, /* v, w of the input */
  FB_BASE_PINNED = 2,     /* O stays where it is, all rotations are free */
  FB_BASE_HINGED = 3,     /* O and the z axis stay where they are, the body turns about z */
  FB_BASE_COUNT
} fb_base;

/* A symmetric n x n matrix by its diagonal and those elements below it (a > b) that are not zero. Modal matrices are a
   diagonal, finite-element ones blocks and bands. */
typedef struct fb_pair_term {
  fb_real c;
  unsigned short a, b;
} fb_pair_term;

typedef struct fb_sparse {
  int n_term;
  fb_real diagonal[FB_MAX_MODES];
  fb_pair_term term[FBI_MAX_PAIRS];
} fb_sparse;

/* The elements of Lambda(q) (6 x n) and S(q) (6 x 6, packed) that are not zero. A term is one struct: gcc 12.2 -O2
   drops a call whose loop runs over parallel arrays of reals and bytes of one struct. */
typedef struct fb_lambda_term {
  fb_real c;
  unsigned char i, a, b;
} fb_lambda_term;

typedef struct fb_lambda_row { /* row i of Lambda, and where its terms linear in q end in the list; ascending */
  unsigned short i, end;
} fb_lambda_row;

#if FB_MAX_LAMBDA > 0
#define FBI_MAX_LAMBDA FB_MAX_LAMBDA
#else
#define FBI_MAX_LAMBDA                                                                                 \
  (FB_MAX_MODES * (6 + 3 * FB_MAX_MODES * (FB_WITH_SPIN_COUPLING || FB_WITH_ACCELERATION_STIFFENING) + \
                   3 * FB_MAX_MODES * FB_WITH_ACCELERATION_STIFFENING))
#endif
/* pairs a >= b of (1, q) but 00 */
#define FBI_MAX_PAIRS_S (FBI_WITH_SHAPE_INERTIA ? (FB_MAX_MODES + 1) * (FB_MAX_MODES + 2) / 2 - 1 : 1)
#if FB_MAX_S > 0
#define FBI_MAX_S FB_MAX_S
#else
#define FBI_MAX_S (FBI_WITH_SHAPE_INERTIA ? 27 * FBI_MAX_PAIRS_S : 1) /* elements of S, of J beside them in its slope */
#endif

#if FB_WITH_NONLINEAR_STRAIN
typedef struct fb_strain_row { /* what a coordinate adds to u_x', u_y' or u_z' (axis 0, 1, 2) at the strain stations */
  fb_real slope[FBI_MAX_STRAINS];
  unsigned short axis, a;
} fb_strain_row;
#endif

/* The model a step needs; constant after init, may live in ROM. */
typedef struct fb_body {
  int n, n_node;    /* modes, nodes */
  int n_coordinate; /* modes and rotors */
  unsigned effects;
  fb_base base;
  int unit_mass;  /* M = 1 */
  int constant_S; /* S does not depend on q */
  int allow_long_step;
  int n_lambda, n_lambda_constant; /* terms of Lambda; those of a = 0 come first */
  int n_linear_constant, n_linear; /* of either kind those of the linear momentum, first among them */
  int n_row;                       /* rows of Lambda that have terms linear in q */
  int by_velocities;               /* slope of the kinetic energy at fixed velocities, E8.49 */
  int n_S, n_slope_alone, n_slope; /* terms of S: the first are those of its slope, of which some are not in S */
  fb_real mass, c[3];
  fb_real deflection_limit, reach[FB_MAX_MODES];
  fb_real recoil; /* sqrt of the largest ratio of the body's inertia to what the modes leave the frame; 1: heavy hub */
  fb_real gyration;                                                     /* [m] radius of gyration about O */
  fb_real limit_elastic, limit_damping, limit_spin, limit_acceleration; /* bounds for fb_rk4_limit */
#if FB_WITH_NONLINEAR_STRAIN
  int n_strain, n_strain_row;
  fb_real quartic;       /* 1, or 0 where the strain energy of degree 4 is left out */
  fb_real limit_slope;   /* largest eigenvalue of EA u_y' u_y' + EA u_z' u_z' against the elastic mass */
  fb_real limit_tension; /* [s] change of a frequency by the tension of a spin, per spin squared */
  fb_real strain_weight[FBI_MAX_STRAINS];
  fb_strain_row strain_row[3 * FB_MAX_MODES];
#endif
#if FB_WITH_LARGE_DEFLECTION
  fb_lines lines;
  fb_sparse M_rest;  /* elastic mass and.. */
  fb_real c_rest[3]; /* ..first moment of mass without those of the lines */
#endif
  fb_real S0[21], S0_inverse[36]; /* with lines M_rr of the rest of the body; S of all of it, inverted */
  fb_sparse M, Minv, K;           /* elastic mass (it and its inverse are used when not 1) and stiffness */
#if FB_WITH_DAMPING
  fb_sparse C;
#endif
#if FB_WITH_GRAVITY
  fb_real gravity[3], mu, center[3];
#endif
#if FB_WITH_ROTORS
  int n_rotor;
  fb_rotor rotor[FB_MAX_ROTORS];
#endif
  fb_lambda_row lambda_row[6];
  fb_lambda_term lambda[FBI_MAX_LAMBDA]; /* -Lambda_ib(q) = sum of c (1, q)_a */
  /* S_i(q) = S0_i + sum of c (1, q)_a (1, q)_b, a >= b; i = 21..26: c_x, c_y, c_z, W_xx, W_yy, W_zz, first and second
     moments of mass, each in two elements (E8.11) */
  fb_lambda_term S[FBI_MAX_S];
  fb_node node[FB_MAX_NODES];
} fb_body;

/* Is a body what fb_body_init may have made? Counts and indexes within the tables, the terms in their order, all
   numbers finite, S_0 positive definite: for memory that may have changed by itself. A body that passes takes no step,
   whatever else is wrong with it, beyond its tables; a number that is finite but wrong passes, too. FB_ERR_CAPACITY,
   FB_ERR_VALUE. */
FB_API fb_status fb_body_check(const fb_body *body);
/* Check word of a body: CRC-32 (IEEE 802.3) over all that a step reads, in the order of its members, without padding
   and unused room. Keep it beside the model, compare in flight: a single flipped bit changes it. It depends on
   FB_SINGLE, not on the capacities. 0: counts beyond the tables (whether the numbers are sound, fb_body_check says). */
FB_API unsigned fb_body_crc(const fb_body *body);

/* All that changes; assignment is a snapshot. Momenta are relative to the mass center, which moves at u: rho alone
   depends on the speed of flight, and a body at 30 km/s bends as one at rest. fb_body_motion_eval and
   fb_body_momentum_eval give totals. */
typedef struct fb_state {
  fb_real rho[3];  /* [m] position of O, inertial axes; steps add to it without loss (lost_rho) */
  fb_real quat[4]; /* attitude of the body frame */
  fb_real u[3];    /* [m/s] velocity, inertial axes: of the mass center; prescribed base: that of O at the end of the
                      last step; pinned, hinged: zero */
  fb_real L[3];    /* [N m s] angular momentum, inertial axes, about the mass center; pinned: about O; hinged: about O,
                      along the hinge; prescribed: zero */
  /* elastic coordinates, behind them the angles of rotors [rad]; conjugate momenta, int psi_a . (velocity - u) dm and
     of rotors [N m s] */
  fb_real q[FBI_MAX_COORDINATES], pi[FBI_MAX_COORDINATES];
  fb_real h[3]; /* [N m s] L in body axes, as the last step had it: written, not read */
  /* Kahan compensation terms of the last update. Set to zero when you write a state. */
  fb_real lost_rho[3], lost_u[3];
#if FB_SINGLE
  fb_real lost_quat[4], lost_L[3], lost_h[3], lost_q[FBI_MAX_COORDINATES], lost_pi[FBI_MAX_COORDINATES];
#endif
} fb_state;

typedef enum fb_axes {
  FB_AXES_INERTIAL = 0, /* dead load */
  FB_AXES_NODE = 1,     /* follower: turns with the node's section */
  FB_AXES_BODY = 2,     /* turns with the body frame */
  FB_AXES_COUNT
} fb_axes;

typedef struct fb_load {
  int node;
  fb_axes axes;
  fb_real force[3], torque[3]; /* [N], [N m] in those axes, at the node */
} fb_load;

typedef struct fb_input { /* what acts on a body at one instant; all zero: nothing */
  int n_load;
  fb_load load[FB_MAX_LOADS];
  /* [m/s], [rad/s] prescribed base: velocity of O and angular velocity, body axes. What the attitude of the integrator
     errs by within a step times v is felt as a velocity: let a base that flies fast and turns unsteadily fly against a
     frame that flies along (any velocity that does not change may be left out) */
  fb_real v[3], w[3];
  fb_real v_dot[3], w_dot[3]; /* [m/s^2], [rad/s^2] their rates in body axes: accelerations, reactions, step limit, and
                                 the equations of motion of the second- and first-order forms */
#if FB_WITH_ROTORS
  fb_rotor_input rotor[FB_MAX_ROTORS]; /* of rotors that the body does not have zero, or FB_ERR_VALUE */
#endif
#if FB_WITH_LARGE_DEFLECTION
  fb_real t;                  /* [s] for distributed */
  fb_distributed distributed; /* loads along the lines; NULL: none. FB_ERR_UNSUPPORTED: the body has no lines */
  void *user;
#endif
} fb_input;

typedef struct fb_motion { /* velocities and accelerations, body axes */
  fb_real v[3], w[3], q_dot[FB_MAX_MODES];
  fb_real acceleration[3], w_dot[3], q_ddot[FB_MAX_MODES]; /* of O [m/s^2]; rates of w and q_dot */
  fb_real reaction_force[3], reaction_torque[3]; /* [N], [N m] of the base on the body at O; zero for what is free */
#if FB_WITH_ROTORS
  fb_real rotor_speed[FB_MAX_ROTORS], rotor_momentum[FB_MAX_ROTORS]; /* [rad/s] relative to the node; [N m s] */
#endif
} fb_motion;

typedef struct fb_node_motion { /* inertial axes */
  fb_real position[3], quat[4]; /* of the node and its section */
  fb_real velocity[3], angular_rate[3];
  fb_real acceleration[3], angular_acceleration[3];
  fb_real displacement[3], rotation[3]; /* elastic, body axes [m], rotation vector [rad], within half a turn */
} fb_node_motion;

typedef struct fb_energy { /* [J] */
  fb_real kinetic, strain;
  fb_real gravity; /* -m g.(rho + R c(q)/m), zero with the mass center at the origin; of a center zero far from it */
} fb_energy;

typedef struct fb_momentum {
  fb_real linear[3], angular[3]; /* [N s], [N m s] about the inertial origin, inertial axes */
} fb_momentum;

/* At the inertial origin, at rest, undeformed. A prescribed base that moves from the first step on wants
   fb_state_from_velocity with its v, w: a jump in them is an impulse on the modes. */
FB_API fb_status fb_state_init(const fb_body *body, fb_state *state);
/* Sets the momenta of state from v, w (body axes) and q_dot (n, NULL: zero) at its pose and q. FB_ERR_NOT_FINITE;
   FB_ERR_VALUE: a velocity that a pinned or hinged base holds at zero. */
FB_API fb_status fb_state_from_velocity(const fb_body *body, fb_state *state, const fb_real v[3], const fb_real w[3],
                                        const fb_real *q_dot);
#if FB_WITH_ROTORS
/* Sets the speed [rad/s] and the angle [rad] of a rotor relative to its node; the velocities of the body and the other
   rotors stay, momenta follow. input: as fb_body_motion_eval, NULL: nothing. FB_ERR_CAPACITY: no such rotor;
   FB_ERR_VALUE: its momentum is given; FB_ERR_RANGE, FB_ERR_NOT_FINITE. */
FB_API fb_status fb_state_rotor_set(const fb_body *body, fb_state *state, int rotor, fb_real speed, fb_real angle,
                                    const fb_input *input);
#endif
/* Finite, unit quaternion, within the deflection limit (of large deflection: no interval of a line turns by more than
   1.22 rad), u and lost_u zero on a pinned or hinged base. FB_ERR_NOT_FINITE, FB_ERR_VALUE, FB_ERR_RANGE. Every state
   that a step leaves passes. */
FB_API fb_status fb_state_check(const fb_body *body, const fb_state *state);
/* Time derivative of state under input (NULL: nothing acts). rate may not be state. FB_ERR_RANGE: S(q) is no longer
   positive definite, the deflection has left the model. FB_ERR_CAPACITY: a load names a node that does not exist. */
FB_API fb_status fb_body_rates_eval(const fb_body *body, fb_state *rate, const fb_state *state, const fb_input *input);
/* Velocities, accelerations and reactions at state under input (NULL: nothing acts). */
FB_API fb_status fb_body_motion_eval(const fb_body *body, fb_motion *motion, const fb_state *state,
                                     const fb_input *input);
/* Pose, velocity and acceleration of a node, from the motion at the same state. */
FB_API fb_status fb_body_node_motion_eval(const fb_body *body, fb_node_motion *out, const fb_state *state,
                                          const fb_motion *motion, int node);
#if FB_WITH_GRAVITY
/* g [m/s^2]: gravity at a place, uniform and of a center, inertial axes, for fb_imu_eval. FB_ERR_RANGE: at the center;
   FB_ERR_NOT_FINITE. */
FB_API fb_status fb_body_gravity_eval(const fb_body *body, fb_real g[3], const fb_real position[3]);
#endif
#if FB_WITH_LARGE_DEFLECTION
typedef struct fb_line_motion {
  fb_line_point at;                                 /* with the distributed load that acts there */
  fb_real acceleration[3], angular_acceleration[3]; /* [m/s^2], [rad/s^2] inertial axes */
  fb_real force[3], moment[3]; /* [N], [N m] internal loads, section axes: force[0] tension, moment[0] torsion */
} fb_line_motion;
/* Motion and internal loads at all points of the lines of a single body: point[FB_MAX_LINE_POINTS], *n of them, in the
   order of fb_distributed. motion and input are those of fb_body_motion_eval at state.
   Internal loads are what the part beyond the section exerts on it, at the line, by equilibrium: loads of the input,
   gravity, damping and inertia forces of all that is outboard, with lumped bodies and loads at the point itself. At a
   root at rest they are the load on the hub. They balance the motion as computed: what the modes miss of it is missing
   in them (blades that spin: take fb_modes_desc.spin).
   FB_ERR_UNSUPPORTED: a body without lines, with central gravity, or with a rotor on a node that moves;
   FB_ERR_NOT_FINITE; a status of input->distributed. */
FB_API fb_status fb_body_lines_eval(const fb_body *body, fb_line_motion *point, int *n, const fb_state *state,
                                    const fb_motion *motion, const fb_input *input);
typedef struct fb_node_loads { /* internal loads, section axes: force[0] tension, moment[0] torsion */
  fb_real force[3], moment[3]; /* [N], [N m] */
} fb_node_loads;
/* Internal loads as fb_body_lines_eval at a node anywhere on a line, with what acts at the node. FB_ERR_UNSUPPORTED: a
   node on no line; FB_ERR_CAPACITY: no such node. */
FB_API fb_status fb_body_node_loads_eval(const fb_body *body, fb_node_loads *loads, const fb_state *state,
                                         const fb_motion *motion, const fb_input *input, int node);
#endif
FB_API fb_status fb_body_energy_eval(const fb_body *body, fb_energy *energy, const fb_state *state,
                                     const fb_input *input);
FB_API fb_status fb_body_momentum_eval(const fb_body *body, fb_momentum *momentum, const fb_state *state,
                                       const fb_input *input);

typedef struct fb_imu {                       /* section axes of the node */
  fb_real specific_force[3], angular_rate[3]; /* [m/s^2] acceleration less gravity, [rad/s] */
} fb_imu;
/* What an inertial measurement unit at a node reads; gravity in inertial axes at the node (NULL: none; with that of a
   center: fb_body_gravity_eval). */
FB_API void fb_imu_eval(fb_imu *imu, const fb_node_motion *node, const fb_real *gravity);

#if FB_WITH_SYSTEM
/* ---------------------------------------------------------------------------------------------------------------
   RUN >>system: bodies connected by joints. Each body hangs by one joint on an earlier body or on the ground (a tree);
   further joints close loops. The state is the joint coordinates with the momenta conjugate to them, so that velocities
   come from one solve M(q) u = p and no accelerations are needed:
     p_dot = joint torque + A^T ( F - turning of G ) + A_dot^T G     G momentum, F load of all that hangs on the joint
   Constraints add impulses: M u = p + A^T mu with A u + b = 0, p_dot less A_dot^T mu; mu starts at zero in every
   step. */

#define FB_GROUND (-1)

/* z, x: axes of the joint frame */
typedef enum fb_joint_kind {
  FB_JOINT_FREE = 0,        /* six speeds (v, w) against the ground, maybe on springs; parent is ignored */
  FB_JOINT_RIGID = 1,       /* no motion */
  FB_JOINT_REVOLUTE = 2,    /* angle about z */
  FB_JOINT_PRISMATIC = 3,   /* slide along z */
  FB_JOINT_CYLINDRICAL = 4, /* angle about z, slide along z */
  FB_JOINT_SCREW = 5,       /* angle about z, slides by pitch times it */
  FB_JOINT_UNIVERSAL = 6,   /* angle about z, then about the rotated x */
  FB_JOINT_SPHERICAL = 7,   /* any rotation; speeds about the child's joint axes */
  FB_JOINT_COUNT
} fb_joint_kind;

typedef enum fb_axis_mode {
  FB_AXIS_FREE = 0,       /* moves by its spring, damper and motor */
  FB_AXIS_LOCKED = 1,     /* stays as it is */
  FB_AXIS_PRESCRIBED = 2, /* moves as the input says, by value and rate: see fb_drive */
  FB_AXIS_COUNT
} fb_axis_mode;

/* The methods are the same mechanics. RECURSIVE and DENSE agree to round-off, which grows towards a singular position
   as one over the least pivot of the loops (E9.9, the squared sine of how far they are from it). Prescribed rates
   contradict a loop where they miss it by a millionth of the speeds (a hundredth in single precision); near a singular
   position, or where the loop is open, by more, at most by a hundredth (a tenth).
   Joints as constraints, in place of elimination: give the bodies free joints and write the joints as loops. Every body
   then needs a positive definite S(q) of its own, which a bare clamped beam loses at small deflections (add a hub), and
   a row counts as dependent sooner where a heavy body is behind a light one. */
typedef enum fb_method {
  FB_METHOD_RECURSIVE = 0, /* tree in joint coordinates, work linear in the number of bodies */
  FB_METHOD_DENSE = 1,     /* by one dense LU of all speeds (FB_MAX_SPEEDS) */
  FB_METHOD_COUNT
} fb_method;

#define FBI_MAX_JOINTS (FB_MAX_BODIES + FB_MAX_LOOPS) /* joints of the tree, then loops */
#define FBI_MAX_ENDS (2 * FBI_MAX_JOINTS)

typedef struct fb_joint { /* a checked desc */
  fb_joint_kind kind;
  int parent, parent_node, child, child_node;
  int n_axis;                   /* speeds */
  int moves;                    /* the parent's node moves in its body */
  int turned;                   /* the joint axes on the child are not the body's */
  int about;                    /* 1..3: it turns about that axis of both bodies, 4..6: against it; 0: about none */
  int moored;                   /* a free joint has springs or dampers, 2: springs of the rotation, too */
  fb_real position[3], axes[9]; /* joint frame in the parent's node axes; where the node does not move: in the body's */
  fb_real child_position[3], child_axes[9]; /* in the child's body or, of a loop, node axes */
  fb_real A[18];                            /* twists of the axes, child's axes about its origin, 6 each */
  fb_real pitch, stiffness[6], rest[6], damping[6];
  fb_real friction[3], friction_speed[3], stop[3][2], stop_stiffness[3], stop_loss[3];
  fb_real bias[3]; /* of linear models: effort of friction beyond that of a damper */
  fb_axis_mode mode[3];
  int rubs; /* an axis has friction or stops */
} fb_joint;

/* Spring, damper and actuator along the line between two points: tension = stiffness (distance - length) +
   damping d(distance)/dt + fb_system_input.pull. The points may meet only if length, damping and pull are zero. */
typedef struct fb_spring {
  int body[2], node[2];   /* or FB_GROUND, node 0 */
  fb_real position[2][3]; /* [m] of each point from its node, in axes of its section; on the ground inertial */
  fb_real stiffness, length, damping; /* [N/m], [m] unstretched, [N s/m] */
} fb_spring;

typedef struct fb_system { /* constant after init, may live in ROM; the models stay with the caller */
  int n_body, n_loop, n_spring;
  fb_method method;
  int allow_long_step;
  int model[FB_MAX_BODIES];
  int coupled[FB_MAX_BODIES]; /* something hangs on a node that its modes move */
  int tied;                   /* constraints tie free trees, 1: to each other, 2: to the ground */
  int carries_rotors;         /* a body has rotors inside */
  int rubs;                   /* a joint has friction or stops */
  int moored;                 /* a free joint has springs or dampers */
  fb_real limit_elastic; /* [1/s^2] largest eigenvalue of springs and modes against the system's mass, undeformed */
  fb_real limit_damping; /* [1/s] the same of the dampers */
  fb_real limit_loop_elastic, limit_loop_damping;     /* what springs and dampers of joints of loops add at most */
  fb_real limit_spring_elastic, limit_spring_damping; /* and those between points, at zero joint coordinates */
  fb_joint joint[FBI_MAX_JOINTS];
  fb_spring spring[FB_MAX_SPRINGS];
} fb_system;

typedef struct fb_link_state {
  fb_real x[3];    /* joint coordinates [rad], [m]; free: position of O, inertial axes */
  fb_real quat[4]; /* spherical: child's joint axes to parent's; free: attitude of the body */
  /* conjugate momenta, of all that hangs on the joint; spherical: angular momentum about the joint, free: P, L about O,
     inertial axes */
  fb_real p[6];
  fb_real q[FBI_MAX_COORDINATES], pi[FBI_MAX_COORDINATES]; /* elastic coordinates and conjugate momenta, behind them
                                                              angles and momenta of rotors, as in fb_state */
  /* free: velocity [m/s, inertial axes] of the frame that all momenta of the tree on this joint are relative to, chosen
     anew by every step so that they stay small: fast flight takes nothing from the digits of the motion. Of free trees
     that loops tie all are the same; zero where they are tied to the ground */
  fb_real u[3];
  fb_real lost_x[3], lost_u[3]; /* what x of a free joint and u have lost by rounding: x + lost_x is accurate to
                                   rounding of its size for ever */
#if FB_SINGLE
  /* as in fb_state; lost_x of all joints */
  fb_real lost_quat[4], lost_p[6], lost_q[FBI_MAX_COORDINATES], lost_pi[FBI_MAX_COORDINATES];
#endif
} fb_link_state;

typedef struct fb_system_state { /* all that changes; assignment is a snapshot */
  fb_link_state link[FB_MAX_BODIES];
  /* [J] done by motors and actuators; not by prescribed axes, nor by rotors whose momentum is given */
  fb_real motor_work;
  fb_axis_mode mode[FBI_MAX_JOINTS][3];                          /* change it by fb_system_axis_set */
  fb_real hold[FBI_MAX_JOINTS][3], hold_quat[FBI_MAX_JOINTS][4]; /* where a joint of a loop was locked */
} fb_system_state;

/* A joint in coordinates: value[i] of axis i, quat and position as in fb_link_state; speed of each axis; spherical: w
   of the child relative to the parent, about its joint axes; free: v, w in body axes. */
typedef struct fb_link_motion {
  fb_real value[3], quat[4]; /* all zero: identity */
  fb_real speed[6];
  fb_real q[FB_MAX_MODES], q_dot[FB_MAX_MODES];
#if FB_WITH_ROTORS
  fb_real rotor_speed[FB_MAX_ROTORS], rotor_angle[FB_MAX_ROTORS]; /* [rad/s], [rad] relative to its node; the speed of
                                                                     one whose momentum is given is not read */
#endif
} fb_link_motion;

/* Value and rate of a prescribed axis belong together. A step is refused (FB_ERR_CONTRADICTION) where a value changes,
   in it or from the state to its start, by more than twice what its largest rate makes of the step: a jump would keep
   the momenta of all that hangs on the axis and so give speeds to joints and modes further out. Not refused: values of
   loops, whose states have none, and one input for all of a step, of which it is not known how the value came there. */
typedef struct fb_drive { /* of a joint, by axis */
  /* [N m], [N] of the motor on the child (and back on the parent), of free axes; [0] is the first axis of the joint. An
     axis that the joint does not have has no motor, nor has a free joint: FB_ERR_VALUE unless zero (load a node) */
  fb_real torque[3];
  fb_real value[3]; /* [rad], [m] of prescribed axes; free and spherical joints integrate the rate instead */
  fb_real rate[6];
  fb_real acceleration[6]; /* for accelerations and reactions only */
} fb_drive;

typedef struct fb_system_load {
  int body;
  fb_load load;
} fb_system_load;

/* A constraint between velocities: sum of force[s] . v + torque[s] . w over its one or two nodes, plus b, is zero;
   force and torque are the directions in which it acts, inertial axes; body FB_GROUND: that side is not there. */
typedef struct fb_row {
  int body[2], node[2];
  fb_real force[2][3], torque[2][3];
  fb_real b;
  int holonomic; /* 1: it is the rate of value, which is brought back to zero after every step */
  fb_real value;
} fb_row;

typedef struct fb_pose {     /* of a body */
  fb_real position[3], R[9]; /* [m] of O, inertial axes; body to inertial axes */
} fb_pose;

/* The caller's own constraints, at time t and the poses of all bodies: writes at most `capacity` rows and returns their
   number; always the same rows in the same order. A negative number is a status and ends the call. */
typedef int (*fb_rows)(fb_row *row, int capacity, const fb_pose *pose, fb_real t, void *user);

typedef struct fb_load_point { /* the node of fb_system_input.load of the same number, inertial axes */
  int body, node;
  fb_real position[3], R[9];            /* [m]; section to inertial axes */
  fb_real velocity[3], angular_rate[3]; /* [m/s], [rad/s] */
  fb_real force[3], torque[3];          /* [N], [N m] to be written: what acts beside the load */
} fb_load_point;

typedef struct fb_joint_point { /* a joint: that of the body of the same number, then the loops */
  fb_real value[3], speed[3];   /* as fb_joint_motion; zero of a free joint */
  fb_real torque[3];            /* [N m], [N] to be written: what its motors do beside fb_drive.torque, by axis */
} fb_joint_point;

typedef struct fb_spring_motion { /* between its points */
  fb_real length, rate;           /* [m], [m/s] distance and its rate */
  fb_real tension;                /* [N] of spring, damper and actuator */
} fb_spring_motion;

typedef struct fb_system_forces { /* all that forces may depend on */
  fb_real t;                      /* [s] of the input */
  int n_point, n_joint, n_spring;
  fb_load_point point[FB_MAX_LOADS];
  fb_joint_point joint[FBI_MAX_JOINTS];
  fb_spring_motion spring[FB_MAX_SPRINGS]; /* tension: before the callback without the pull below */
  fb_real pull[FB_MAX_SPRINGS];            /* [N] to be written: what its actuator does beside fb_system_input.pull */
} fb_system_forces;

/* Forces as functions of the state: reads how nodes, joints and springs move, and writes what acts on them (zero
   before). A node is seen and loaded if a load, which may be zero, names it. Called once an evaluation, also at
   attempts: keep no history in it. What grows with deflection or velocity is not part of the step limit: with a penalty
   of stiffness k [N/m] on a mass m [kg] rk4 takes steps below 2.7 sqrt(m/k); fb_system_sdirk_step finds it by
   iteration, FB_ERR_CONVERGENCE from about sqrt(m/k) on. A status other than FB_OK ends the call. FB_ERR_NOT_FINITE: it
   wrote what is no number; FB_ERR_VALUE: a torque on an axis without motor. */
typedef fb_status (*fb_forces)(fb_system_forces *now, void *user);

typedef struct fb_system_input { /* all zero: nothing acts */
  int n_load;
  fb_system_load load[FB_MAX_LOADS];
#if FB_WITH_ROTORS
  fb_rotor_input rotor[FB_MAX_BODIES][FB_MAX_ROTORS]; /* of each body, as in fb_input */
#endif
  fb_real pull[FB_MAX_SPRINGS];   /* [N] of the actuators: tension */
  fb_drive drive[FBI_MAX_JOINTS]; /* by joint: that of the body of the same number, then the loops */
  fb_rows rows;                   /* NULL: none */
  fb_forces forces;               /* NULL: none */
  void *user;                     /* for rows, forces and distributed */
  fb_real t;                      /* [s] for rows, forces and distributed */
#if FB_WITH_LARGE_DEFLECTION
  /* loads along the lines of all bodies that have them; NULL: none. FB_ERR_UNSUPPORTED: no body has lines */
  fb_distributed distributed;
#endif
} fb_system_input;

/* Scratch; large: make it static. .joint: after a failure the joint at fault, loops after the bodies; -1: none; -2 - k: row
   k of the caller's. */
typedef struct fb_system_work fb_system_work;

/* ---- functions; body is the caller's array of models, the same in every call. Bodies of a system are of the momentum
   form; their base does not matter: FB_BASE_PRESCRIBED takes bodies without mass, or without inertia about some
   axis. */

/* As fb_body_check, the models among it. */
FB_API fb_status fb_system_check(const fb_system *system, const fb_body *body, int n_model);
/* Check word as fb_body_crc, of joints and loops and of the models that the bodies have. 0: counts beyond the tables, a
   model that does not exist. */
FB_API unsigned fb_system_crc(const fb_system *system, const fb_body *body, int n_model);
/* Finite, within the deflection limits, modes of axes that exist, quaternions of unit length to 1e-3.
   FB_ERR_NOT_FINITE, FB_ERR_RANGE, FB_ERR_VALUE. */
FB_API fb_status fb_system_state_check(const fb_system *system, const fb_body *body, const fb_system_state *state);
/* State from joint coordinates and speeds; motion: one for each body, NULL: all zero, at rest. Prescribed axes take
   value and speed from the input, locked ones are at rest. Loops are then closed, by joints and, where these cannot,
   modes, each step the least change of positions and velocities by kinetic energy. That may change given ones: prescribe
   what must stay. Locked axes of loops stay where that leaves them.
   FB_ERR_CONTRADICTION: a loop cannot be closed, or closes half a turn off (work->joint); FB_ERR_NOT_FINITE;
   FB_ERR_RANGE. */
FB_API fb_status fb_system_state_init(const fb_system *system, const fb_body *body, fb_system_state *state,
                                      fb_system_work *work, const fb_link_motion *motion, const fb_system_input *input);
/* Locks, frees or hands over to the input an axis of a joint (of a loop: n_body + its number; spherical and free: all
   axes). Momenta are what is kept: locking a moving axis is a plastic impact within the system. */
FB_API fb_status fb_system_axis_set(const fb_system *system, const fb_body *body, fb_system_state *state,
                                    fb_system_work *work, int joint, int axis, fb_axis_mode mode,
                                    const fb_system_input *input);
/* Time derivative of a state; mode and hold of rate are zero. FB_ERR_UNDETERMINED: an axis moves no inertia;
   FB_ERR_CONTRADICTION: constraints against each other (work->joint); FB_ERR_RANGE: a deflection, or the points of a
   spring meet; FB_ERR_CAPACITY: also more than 2 (FB_MAX_BODIES + FB_MAX_LOOPS) nodes in constraints;
   FB_ERR_NOT_FINITE. */
FB_API fb_status fb_system_rates_eval(const fb_system *system, const fb_body *body, fb_system_work *work,
                                      fb_system_state *rate, const fb_system_state *state,
                                      const fb_system_input *input);

typedef struct fb_joint_motion {
  /* of the axes; spherical: value is the rotation vector. Of joints of loops angles are within half a turn, also for
     their springs, and accelerations are zero */
  fb_real value[3], speed[6], acceleration[6];
  fb_real force[3], torque[3]; /* [N], [N m] of the joint on the child, about its joint frame, inertial axes */
  fb_real drive[3]; /* of them the part along each axis: motor, spring, damper, friction and stop, or what holds it */
} fb_joint_motion;

typedef struct fb_system_motion {
  fb_state pose[FB_MAX_BODIES];    /* rho, quat, q of every body, for fb_body_node_motion_eval with.. */
  fb_motion motion[FB_MAX_BODIES]; /* ..this; reactions: of all joints and rows on the body about O, body axes */
  fb_joint_motion joint[FBI_MAX_JOINTS];
  fb_spring_motion spring[FB_MAX_SPRINGS];
  fb_real force[FB_MAX_LOADS][3], torque[FB_MAX_LOADS][3]; /* [N], [N m] of fb_forces at the loads, inertial axes */
  fb_real power;                                           /* [W] of motors, actuators and of what prescribes axes */
} fb_system_motion;

/* Motion of all bodies and joints at a state: velocities, accelerations, joint forces. Errors as
   fb_system_rates_eval. */
FB_API fb_status fb_system_motion_eval(const fb_system *system, const fb_body *body, fb_system_work *work,
                                       fb_system_motion *motion, const fb_system_state *state,
                                       const fb_system_input *input);
#if FB_WITH_LARGE_DEFLECTION
/* fb_body_lines_eval of body k, loaded by joints, too; motion: fb_system_motion_eval with that input.
   FB_ERR_UNSUPPORTED: a body without lines; with rows, whose forces motion does not hold. */
FB_API fb_status fb_system_lines_eval(const fb_system *system, const fb_body *body, fb_line_motion *point, int *n,
                                      const fb_system_motion *motion, const fb_system_input *input, int k);
/* fb_body_node_loads_eval of body k, likewise. */
FB_API fb_status fb_system_node_loads_eval(const fb_system *system, const fb_body *body, fb_node_loads *loads,
                                           const fb_system_motion *motion, const fb_system_input *input, int k,
                                           int node);
#endif
/* strain holds the springs of joints and between points, too. */
FB_API fb_status fb_system_energy_eval(const fb_system *system, const fb_body *body, fb_system_work *work,
                                       fb_energy *energy, const fb_system_state *state, const fb_system_input *input);
FB_API fb_status fb_system_momentum_eval(const fb_system *system, const fb_body *body, fb_system_work *work,
                                         fb_momentum *momentum, const fb_system_state *state,
                                         const fb_system_input *input);

#endif /* FB_WITH_SYSTEM */

#if FB_WITH_EXACT
/* ---------------------------------------------------------------------------------------------------------------
   RUN >>exact: the geometrically exact beam with displacements, rotations, velocities, momenta, strains and internal
   loads as fields of their own ([L] 3.92-3.105): any deflection, any rotation, full 6x6 sections. For each element

     h strain_t = D1 V1 + D2 V2        V = (velocity, angular velocity) of the nodes, section axes
     momentum   = M (A1 V1 + A2 V2)    X = h ad(1 + force strain, curvature), A = 1/2 -+ tanh(X/4)/2, D2 = X/(1 - e^-X)
     F2 = D2^T s - h A2^T f            s = stiffness strain, F = (force, moment) at the nodes, f = load less momentum_t

   piecewise constant in space and time as in [L], but for the compliance, which has the variation of the strain, the
   mass, two thirds of which move with the middle of an element and a sixth with each node, and rotary inertia, of which
   the nodes have two thirds about the line and all across it: at the nodes a linear beam is then exact, a bent one, the
   bending frequencies of a straight one without shear and rotary inertia and those of its twist are of order 4, motion
   in time and all else of order 2 (first frequency between hinges, GA = 200 EI/L^2: 2.0e-4, 4.9e-5, 1.2e-5 high with 10,
   20, 40 elements, 1.0e-5, 6.3e-7, 4.0e-8 without). A1 V1 + A2 V2 is the velocity of a pose, the middle
   between those of the nodes: the beam is a Hamiltonian system at any mesh, and what is stable without loss has no growth
   but rounding, spinning with its mass off its line, too. An element that turns, by bending or as built, by 15 degrees is
   9e-4 too stiff, by 45 degrees 8e-3, by 90 degrees 5 percent, of order 4: keep it below 15 degrees where that counts. A
   is to D as velocity is to strain, so that energy passes from element to element without loss, whatever the mesh and the
   step.
   Cost and memory are linear in the elements: 12 unknowns for each, eliminated from the tip to the root.
   Elements may be joints, hinges with springs, dampers and motors: links, folded booms, hinged blades, closed chains whose
   tip is held, are one such beam. A joint keeps energy as the elements do; its outboard side wants inertia, or a spring,
   about its axis, else steps end in FB_ERR_SINGULAR, as does fb_exact_trim where a joint can turn freely.
   Elements form a tree: fb_exact_desc.branch begins further chains at any node, at any angle (hubs with several booms,
   frames, rotors). A branch costs its elements, and one more where it stands at an angle. */

/* What an end, or a node, is held in: directions x, y, z of the base, rotations about its section axes x, y, z: all of
   them, two (a hinge), or none; one alone has a meaning for small rotations only: a steady state holds that component
   of the rotation vector, a step and a linear model the rate about that axis of the section, which is another condition
   where the node has turned far about the others. */
#define FB_HOLD_X 1
#define FB_HOLD_Y 2
#define FB_HOLD_Z 4
#define FB_HOLD_RX 8
#define FB_HOLD_RY 16
#define FB_HOLD_RZ 32
#define FB_END_DEFAULT 0  /* clamped root, free tip */
#define FB_END_FREE 64    /* nothing */
#define FB_END_PINNED 7   /* its place */
#define FB_END_CLAMPED 63 /* place and rotation */
#define FB_END_GUIDED 56  /* rotation */
#define FB_END_SLIDING 62 /* all but its place along x */

/* Hinge in a beam: an element of length zero, whose nodes have one place. The section outboard of it is rotated against
   the one inboard about an axis fixed in both, by any angle; whole turns count. Several in a row about different axes
   are a universal or a spherical joint; a lumped body on a node between two of them is a link or a hub. */
typedef struct fb_exact_joint {
  int element;                      /* that is the joint */
  int driven;                       /* nonzero: its motor holds its rate, whatever the load */
  fb_real axis[3];                  /* unit vector, section axes of both nodes at angle 0 */
  fb_real angle, rate;              /* [rad] as built, before anything acts; [rad/s] at the start */
  fb_real rest, stiffness, damping; /* of a spring and damper: [rad], [N m/rad] >= 0, [N m s/rad] >= 0 */
} fb_exact_joint;

typedef struct fb_exact { /* a checked desc, in units of the beam's own; constant after init, may live in ROM */
  int n, iterations, floating, box;
  fb_real length, force, time; /* [m], [N], [s] its units: length, EI/length^2, and what makes its mass 1 */
  fb_real beta;                /* of dissipation */
  fb_real damping[6];          /* roots of structural damping */
  fb_real gravity[3];
  int held[FB_MAX_EXACT + 1], factorizations;
  int jointed[FB_MAX_EXACT + 1], n_joint;  /* 1 + the joint that is an element; 0: none */
  int inboard[FB_MAX_EXACT + 1], n_branch; /* inboard node of element k: k, or the one that a branch begins at */
  fb_real h[FB_MAX_EXACT];
  fb_real xi[6 * FB_MAX_EXACT]; /* (1, 0, 0, initial curvature) */
  fb_real C[36 * FB_MAX_EXACT]; /* compliance with that by the strain's variation in the element */
  fb_real S[36 * FB_MAX_EXACT]; /* its inverse, zero where rigid */
  fb_real section[36 * FB_MAX_EXACT],
      taper[36 * FB_MAX_EXACT]; /* the section's own compliance, its change over the element */
  fb_real M[36 * FB_MAX_EXACT], M_inverse[36 * FB_MAX_EXACT]; /* inertia per length that moves with the middle */
  fb_real weight[4 * FB_MAX_EXACT]; /* mass and first moment of mass per length, of the middle */
  /* Mass, first moment and rotary inertia about the mass center (xx, xy, xz, yy, yz, zz) that move with the inboard and
     the outboard node */
  fb_real share[20 * FB_MAX_EXACT];
  fb_real node_M[36 * (FB_MAX_EXACT + 1)], node_weight[4 * (FB_MAX_EXACT + 1)]; /* of the nodes, with lumped bodies */
  fb_real r[3 * (FB_MAX_EXACT + 1)], quat[4 * (FB_MAX_EXACT + 1)];              /* undeformed nodes in the base frame */
  int branch[FB_MAX_LUMPS]; /* elements whose inboard node is another, ascending */
  fb_exact_joint joint[FB_MAX_LUMPS];
} fb_exact;

/* As fb_body_check: counts and indexes within the tables, all numbers finite, units and lengths positive. */
FB_API fb_status fb_exact_check(const fb_exact *exact);
/* Check word as fb_body_crc. 0: counts beyond the tables. */
FB_API unsigned fb_exact_crc(const fb_exact *exact);

typedef struct fb_line_load {  /* per length of the undeformed line */
  fb_axes axes;                /* inertial: dead; node: follower, section axes; body: base axes */
  fb_real force[3], torque[3]; /* [N/m], [N m/m] */
} fb_line_load;

/* Place of what holds a node, tip or support, relative to where it is built: as the base carries it, if the node is none
   of the list. Entries of one node follow each other. Zero along and about what is not held; the root is held by the
   base, which moves by v, w. */
typedef struct fb_support_place {
  int node;
  fb_real displacement[3], rotation[3]; /* [m] base axes; [rad] rotation vector, built section axes */
} fb_support_place;

typedef struct fb_exact_input { /* all zero: nothing acts, the base rests */
  int n_load;
  fb_load load[FB_MAX_LOADS];      /* at nodes */
  fb_line_load line[FB_MAX_EXACT]; /* on elements */
  fb_real v[3], w[3];              /* [m/s], [rad/s] of the base frame, base axes; nothing held: of the start alone */
  /* Motors of the joints: [N m] about the axis, on what is outboard; of a driven one its rate [rad/s] */
  fb_real motor[FB_MAX_LUMPS];
  int n_support;
  fb_support_place support[FB_MAX_LUMPS]; /* where supports are at the end of the step, or in the steady state */
} fb_exact_input;

typedef struct fb_exact_state {           /* all that changes, in the beam's own units; assignment is a snapshot */
  fb_real base_position[3], base_quat[4]; /* base frame, inertial; [m]. Nothing held: the frame of the root section */
  fb_real r[3 * (FB_MAX_EXACT + 1)], quat[4 * (FB_MAX_EXACT + 1)]; /* nodes in the base frame */
  fb_real strain[6 * FB_MAX_EXACT], momentum[6 * FB_MAX_EXACT];    /* of the elements */
  fb_real strain_rate[6 * FB_MAX_EXACT], momentum_rate[6 * FB_MAX_EXACT];
  fb_real velocity[6 * (FB_MAX_EXACT + 1)], velocity_rate[6 * (FB_MAX_EXACT + 1)]; /* of the nodes, after the step */
  fb_real angle[FB_MAX_LUMPS], angle_rate[FB_MAX_LUMPS]; /* of the joints, [rad]; the rate in the last step */
  /* of the middle of the last step, or steady: node velocities and stress of the elements, with those of the two steps
     before it; loads between elements */
  fb_real V[3][6 * (FB_MAX_EXACT + 1)], stress[3][6 * FB_MAX_EXACT], force[6 * (FB_MAX_EXACT + 1)];
  fb_real reaction[6 * (FB_MAX_EXACT + 1)]; /* of what holds the nodes */
  fb_real offset[6 * FB_MAX_EXACT];         /* of the strain, by loads on the elements */
  int known;                                /* of them */
  fb_real step;                             /* length of the last step */
  /* [m/s] inertial axes: velocities and momenta above are relative to it, so that flight at any constant speed, and
     free fall, move as rest does. The functions below give totals. After a step it is the mass center's, of a held beam
     near the base's. */
  fb_real u[3];
  fb_real lost[3]; /* [m] of base_position: what rounding took from it, given back with the next step */
  int n_support;   /* where supports are: of the input of the last step, or of fb_exact_trim */
  fb_support_place support[FB_MAX_LUMPS];
} fb_exact_state;

/* Scratch; large: make it static. .unstable counts the unstable directions of a steady state, .iterations and .increments
   what fb_exact_trim took. */
typedef struct fb_exact_work fb_exact_work;

/* Undeformed, at the inertial origin, in rigid motion with the v, w of the input (NULL: at rest); u is the velocity
   of the mass center, of a beam that is held v. FB_ERR_NOT_FINITE; FB_ERR_CAPACITY: counts of the model; FB_ERR_SINGULAR,
   the state is then empty: a free beam on one line whose rotary inertia about it (i_y, i_z, a lump's) is below FB_EPSILON
   times its mass and the square of its length, 1.2e-7 in single precision. */
FB_API fb_status fb_exact_state_init(const fb_exact *exact, fb_exact_state *state, fb_exact_work *work,
                                     const fb_exact_input *input);

/* Finite, no quaternion zero. FB_ERR_NOT_FINITE, FB_ERR_VALUE; FB_ERR_CAPACITY: counts of the model. */
FB_API fb_status fb_exact_state_check(const fb_exact *exact, const fb_exact_state *state);

typedef struct fb_exact_node {
  fb_real position[3], quat[4];         /* [m], section to inertial axes, after the last step */
  fb_real displacement[3];              /* [m] base axes */
  fb_real rotation[3];                  /* [rad] rotation vector from the undeformed section; whole turns along the beam
                                           count, the root's own is within half a turn */
  fb_real wiener_milenkovic[3];         /* the same as 4 tan(phi/4), phi within half a turn */
  fb_real velocity[3], angular_rate[3]; /* [m/s], [rad/s] section axes, in the middle of the last step; u by its end */
  /* [N], [N m] section axes, in the middle of the last step: of what is outboard on what is inboard, on the inboard
     side of the node (at the root: of the beam on the root); of what holds the node on the beam. */
  fb_real force[3], moment[3], reaction_force[3], reaction_moment[3];
} fb_exact_node;
/* All n + 1 nodes. */
FB_API fb_status fb_exact_nodes_eval(const fb_exact *exact, fb_exact_node *node, const fb_exact_state *state);

/* Means over element k, section axes; loads and strains in the middle of the last step, velocities and momenta after
   it. */
typedef struct fb_exact_element {
  fb_real force[3], moment[3];               /* [N], [N m] */
  fb_real force_strain[3], moment_strain[3]; /* -, [1/m] */
  fb_real velocity[3], angular_rate[3];
  fb_real momentum[3], angular_momentum[3]; /* [kg/s], [N s] per length */
} fb_exact_element;
FB_API fb_status fb_exact_element_eval(const fb_exact *exact, fb_exact_element *element, const fb_exact_state *state,
                                       int k);
/* A joint: after the last step its angle, in the middle of it the rest. */
typedef struct fb_exact_hinge {
  fb_real angle, rate; /* [rad], [rad/s] outboard section against inboard one */
  fb_real moment;      /* [N m] about the axis: of spring, damper and motor on what is outboard */
} fb_exact_hinge;
FB_API fb_status fb_exact_joint_eval(const fb_exact *exact, fb_exact_hinge *hinge, const fb_exact_state *state,
                                     int joint);
/* Point of the deformed line that was x [m] along it, and its section: inertial axes. The lines of branches follow that
   of the chain in their order, end to end: x beyond its length is on the first branch. FB_ERR_VALUE: not on the beam. */
FB_API fb_status fb_exact_point_eval(const fb_exact *exact, fb_real position[3], fb_real quat[4],
                                     const fb_exact_state *state, fb_real x);
/* With dissipation kinetic and strain energy hold beta/4 of that of the last step's change, too: their sum then falls
   in every step of a conservative beam. Follower loads on elements that come or go at once change strains, places never:
   the energy then changes by their part of the strain. This and the momentum refuse what fb_exact_state_check refuses. */
FB_API fb_status fb_exact_energy_eval(const fb_exact *exact, fb_energy *energy, const fb_exact_state *state);
/* A free beam's momentum is that of the start and the impulse of its loads, at any step and speed; then the beam of Simo
   and Vu-Quoc (10 m, 50 N s in 5 s, steps of 10 ms) keeps its energy to 1e-10. Its angular momentum drifts with the step,
   order 2, whatever the mesh. Rigid flight keeps both. */
FB_API fb_status fb_exact_momentum_eval(const fb_exact *exact, fb_momentum *momentum, const fb_exact_state *state);

#endif /* FB_WITH_EXACT */

/* ---------------------------------------------------------------------------------------------------------------
   RUN >>integrate: every step and its limit */

/* Classical Runge-Kutta scheme, order 4, four evaluations. start, middle, end: inputs at t, t + dt/2 and t + dt; the
   same pointer three times holds one input over the step, NULL: nothing acts. The quaternion is normalized, momenta and
   elastic values below FB_TINY become zero.
   FB_ERR_VALUE: dt <= 0; FB_ERR_STEP: dt exceeds fb_rk4_limit at the present spin, acceleration and slopes (unless
   allow_long_step), the angular velocity changes within the step by more than half a radian a step, or the attitude is
   lost; FB_ERR_RANGE, FB_ERR_NOT_FINITE: the motion has left the model.
   A body with lines of large deflection takes 54 kB of stack more in this as in every other call (an fbi_line_work with
   the default FB_MAX_POINTS and FB_MAX_MODES). WHAT A STEP OF ONE BODY RUNS in flexbeam_impl.h lists the functions. */
typedef struct fb_rk4_work {
  fb_state start, stage, rate, sum;
} fb_rk4_work;
FB_API fb_status fb_rk4_step(const fb_body *body, fb_state *state, fb_rk4_work *work, const fb_input *start,
                             const fb_input *middle, const fb_input *end, fb_real dt);
/* Largest stable step [s] of rk4 at a spin |w| [rad/s] and an acceleration of O [m/s^2]: 2.785 / (bound of the highest
   frequency, with rigid-elastic coupling, gyroscopic, stiffening and damping terms). The bound costs no eigenvalues: it
   is up to 9 % too high where two frequencies are equal, as in both planes of a round beam. FB_HUGE: a rigid body at
   rest; 0: an argument that is not a number.
   It is that of the undeformed body, without stiffening by loads and by angular acceleration. The check of the step
   knows the slopes (of 0.1 lower the limit by some 5 %) and, of lines, mass, recoil and the fastest rotation of a
   section: a tip at 80 degrees may allow 1.3 times this step or, beside a hub lighter than the beam, a third.
   In this and the other limits of one body rotors add to the spin sum |momentum| mobility/2, the largest of their
   rates, and |momentum|/inertia of those with an imbalance; central gravity at the distance d adds sqrt(3 mu/d^3). */
FB_API fb_real fb_rk4_limit(const fb_body *body, fb_real spin, fb_real acceleration);

/* The implicit integrators solve their stages by a fixed number of Newton iterations (at most 50) with one n x n
   matrix, factored once a step (LU): the Jacobian of the equations of motion but for stiffening by the quadratic field,
   products of the spin and compression. With FB_EFFECT_LARGE_DEFLECTION it is all but loads and gravity, by differences
   that cost two thirds of n + 1 evaluations. Inputs, status and failure as fb_rk4_step, FB_ERR_STEP beyond fb_implicit_limit. */
typedef struct fb_implicit_work {
  fb_state start, rate, first, base, stage, sum;
  fb_input between;
  fb_real g;                              /* [s] gamma dt of the factored matrix */
  fb_real E[FB_MAX_MODES * FB_MAX_MODES]; /* its factors */
  fb_real K[FB_MAX_MODES * FB_MAX_MODES]; /* tangent stiffness */
  fb_real V[6];                           /* velocities of the gyroscopic terms */
  fb_real X[6 * FB_MAX_MODES], Y[6 * FB_MAX_MODES], Z[6 * FB_MAX_MODES], A[36]; /* recoil of the base */
#if FB_WITH_LARGE_DEFLECTION
  fb_real M[FB_MAX_MODES * FB_MAX_MODES]; /* elastic mass at the start of the step */
  fb_real N[FB_MAX_MODES * FB_MAX_MODES]; /* less the transpose of the derivative of the elastic momenta by q */
  fb_real inertia;                        /* [kg m^2] of the lines' points about O */
#endif
} fb_implicit_work;

/* Largest step [s] of the implicit integrators at a spin |w| [rad/s] and an acceleration of O [m/s^2]: |w| dt <= 1/10,
   less where the quadratic field stiffens much. FB_HUGE at rest, 0 for input that is not a number. It does not know how
   far a body of large deflection bends within a step: one that bends too far is FB_ERR_CONVERGENCE. */
FB_API fb_real fb_implicit_limit(const fb_body *body, fb_real spin, fb_real acceleration);

/* Implicit midpoint rule, order 2, symmetric, without dissipation: fast modes keep ringing, at a frequency that is
   wrong. The energy of a conservative body stays bounded as far as the iterations converge. 1 + iterations
   evaluations (0: 2 iterations). */
FB_API fb_status fb_midpoint_step(const fb_body *body, fb_state *state, fb_implicit_work *work, const fb_input *middle,
                                  fb_real dt, int iterations);

/* Two-stage SDIRK scheme, order 2, L-stable: modes too fast for the step die out at once, slow ones hardly. 1 + 2
   iterations evaluations (0: 2 iterations). The inputs at t and t + dt list loads at the same nodes in the same
   axes. */
FB_API fb_status fb_sdirk_step(const fb_body *body, fb_state *state, fb_implicit_work *work, const fb_input *start,
                               const fb_input *end, fb_real dt, int iterations);

/* Exponential Runge-Kutta scheme of order 4: the constant linear elastic part (K, and M with the recoil of the base) is
   propagated exactly, so that stiff modes do not bound the step; the rest is explicit. Four evaluations and 16 n^2
   flops each for the change to modal coordinates, no factorization. Momentum form only; made for one step size.
   With nonlinear strain the coordinates s = q + G(q) make the membrane strain linear: axial modes follow the
   foreshortening exactly. */
typedef struct fb_exponential { /* constant after init, may live in ROM */
  fb_real dt;
  int n_axial; /* coordinates that take up foreshortening */
  int axial[FB_MAX_MODES];
  /* n_axial x strain stations: s_a = q_a + sum_g G_ag 1/2 (u_y'^2 + u_z'^2)_g */
  fb_real G[FB_MAX_MODES * FBI_EXPONENTIAL_STRAINS];
  fb_real X[FB_MAX_MODES * FB_MAX_MODES];  /* row k: mode k, K x = omega^2 M_free x, X M_free X^T = 1 */
  fb_real MX[FB_MAX_MODES * FB_MAX_MODES]; /* X M_free */
  fb_real omega2[FB_MAX_MODES];
  fb_real half[5][FB_MAX_MODES], full[5][FB_MAX_MODES]; /* Stumpff functions of omega dt/2 and omega dt */
} fb_exponential;
typedef struct fb_exponential_work {
  fb_state start, z, half, full, at, rate, sum, N[4];
} fb_exponential_work;
/* As fb_body_check. */
FB_API fb_status fb_exponential_check(const fb_exponential *scheme, const fb_body *body);
/* Inputs at t, t + dt/2, t + dt; status and failure as fb_rk4_step, FB_ERR_STEP beyond fb_exponential_limit. */
FB_API fb_status fb_exponential_step(const fb_body *body, const fb_exponential *scheme, fb_state *state,
                                     fb_exponential_work *work, const fb_input *start, const fb_input *middle,
                                     const fb_input *end);
/* Largest step [s] of the exponential scheme: |w| dt <= 1/2 for a held base. It is less where the quadratic field or
   the tension of a spinning beam stiffens much, with damping ratios above 1/4, and by the square of fb_body.recoil
   where the base is lighter than its modes and trembles with them: take a heavy hub or an implicit integrator. It holds
   for any motion; a smooth one may be stepped further (allow_long_step). Order 4 shows for modes with omega dt below
   about 5. FB_EFFECT_LARGE_DEFLECTION: for bodies that bend a little. What a deflection changes in the linear part is
   explicit; the step refuses (FB_ERR_STEP) where that change times dt, or the rotation of a section within dt, is too
   large. */
FB_API fb_real fb_exponential_limit(const fb_body *body, fb_real spin, fb_real acceleration);

typedef struct fb_body_limit {
  fb_real rk4, implicit, exponential; /* [s] longest step that each takes from there */
  fb_real spin, acceleration;         /* [rad/s], [m/s^2] that they count, arguments of the limits above */
} fb_body_limit;
/* Longest steps of one body from a state under an input (NULL: none), as the steps judge them: with the slopes, the
   loads and the rotors that are there; exponential with lines of large deflection but for what these change in the
   modes. The steps refuse further what turns or bends too far within one. Statuses as of fb_body_rates_eval. */
FB_API fb_status fb_body_limit_eval(const fb_body *body, fb_body_limit *limit, const fb_state *state,
                                    const fb_input *input);

#if FB_WITH_SYSTEM
/* ---- systems: body is the array of models; the inputs as those of a body */

/* rk4 of a system; after every step positions and velocities are brought onto its constraints (loops, rows).
   FB_ERR_STEP: dt exceeds 2.785 / (bound of the highest frequency): springs and modes of the whole, undeformed at zero
   joint coordinates or, if higher, with lines as they are bent; spin, of rotors nutation; stiffening. Also where the
   angular velocity of a body changes within the step by more than half a radian a step.
   FB_ERR_UNDETERMINED, FB_ERR_CONTRADICTION: work->joint says where; the latter also where a prescribed axis has one
   value at the start and the end of the step but rates of the same sign, or jumps (of different inputs, NULL being one of
   zeros; one that is held over the step does not tell). Let value and rate belong together, with rate 0 where the value stays. Else as fb_rk4_step. */
FB_API fb_status fb_system_rk4_step(const fb_system *system, const fb_body *body, fb_system_state *state,
                                    fb_system_work *work, const fb_system_input *start, const fb_system_input *middle,
                                    const fb_system_input *end, fb_real dt);

/* Two-stage SDIRK of order 2, L-stable, for stiff joints and modes: 2 + 2 iterations evaluations (0: 2 iterations), all
   but the first with one more factorization. The inputs at t and t + dt list the same loads. The fastest spin bounds
   the step, |w| dt <= 1/10, and so does what is explicit: springs and dampers between points; springs, dampers,
   friction and stops of joints of loops. FB_ERR_CONVERGENCE: the last correction is not small (of one iteration the
   first stage alone tells), most of it of the body on work->joint: take a shorter step or more iterations. Else as fb_system_rk4_step. */
FB_API fb_status fb_system_sdirk_step(const fb_system *system, const fb_body *body, fb_system_state *state,
                                      fb_system_work *work, const fb_system_input *start, const fb_system_input *end,
                                      fb_real dt, int iterations);
/* Largest stable step [s] of rk4 for the undeformed system, at a spin [rad/s] and acceleration [m/s^2] of all of it (0,
   0: at rest); for accuracy of the fastest mode take a fifth. Rotors are not in it (fb_system_limit_eval has them).
   With lines the step's own check may allow less, down to a fifth beside hubs much lighter than what bends. */
FB_API fb_real fb_system_rk4_limit(const fb_system *system, const fb_body *body, fb_real spin, fb_real acceleration);

typedef struct fb_system_limit {
  fb_real rk4, sdirk; /* [s] longest step that each takes from there; sdirk: FB_HUGE where nothing turns */
  fb_real spin;       /* [rad/s] rotation that they count: of the body that turns fastest, and nutation by all rotors */
  int body;           /* that turns fastest, its nutation included */
} fb_system_limit;
/* Longest steps from a state, as the steps judge them. Rotors inside bodies count by half the frequency of the nutation
   that their spin causes, so that steps may turn them by any angle, with the rate at which friction brakes them and the
   spin of those with an imbalance. Statuses as of fb_system_rates_eval. */
FB_API fb_status fb_system_limit_eval(const fb_system *system, const fb_body *body, fb_system_work *work,
                                      fb_system_limit *limit, const fb_system_state *state,
                                      const fb_system_input *input);
#endif

#if FB_WITH_EXACT
/* ---- exact beam */

/* One step under loads and motion of the base of its middle. Order 2. Without dissipation the energy of a beam of any
   line and section on a root that is held and at rest, in gravity, under no loads or forces of a fixed direction, is
   constant but for the last correction of the iteration and the work of these, force times way, whatever the step. A
   free beam keeps its momentum to rounding; its energy varies by order 2 of the step, whatever the mesh. A limit of
   stability does not exist; accuracy wants omega dt below about 1 for the modes that matter. Supports beyond the root
   are brought back to their place across the reaction, so that they do no work: within the next step, in steps below
   0.03 fb_exact.time (about a sixtieth of the period of a cantilever's first mode) by the part (dt/0.03 time)^2 of the
   way, so that the reaction does not grow with shorter steps. Of one rotation that is held alone the rate is held, no
   place. Steps may differ; one that is longer than the one before damps with order 1. Where supports are moved the
   input has their places at the end of the step, to which they go at a constant rate; their work, sum of reaction
   times velocity of fb_exact_node, is what the energy grows by. Motion that begins with a velocity, or a jump, is an
   impact that rings without dissipation; FB_ERR_VALUE: a turn of 3 rad in a step. Bounded work: desc.factorizations,
   as many evaluations and at most desc.iterations more, in double precision until the next correction would be
   rounding, three or four as a rule. One factorization, at the extrapolated state, does for all but a stiff beam that
   is held along its line at two places and bends much between them in a step: its stretch is quadratic in that, and
   the iteration contracts slowly. EI = 100 N m^2, 10 m, clamped and pinned at 4 m, let go from 0.4 m, 300 steps that
   are equal or vary by half: one bears 0.1 s up to EA = 1e5 N, two 0.1 s up to 1e7 N, three 0.2 s up to 1e7 N and 0.1
   s at 1e8 N, six equal steps of 0.2 s at 1e8 N. FB_ERR_CONVERGENCE: the last correction is not small, or the residual
   after it not so much smaller that the next one would be below a tenth of its bound (1e-6 of the length, a radian,
   the largest load; single precision 1e-3): take a shorter step, more iterations or factorizations; FB_ERR_SINGULAR: a
   node without inertia and stiffness; else as fb_exact_trim. On failure state is as before. */
FB_API fb_status fb_exact_step(const fb_exact *exact, fb_exact_state *state, fb_exact_work *work,
                               const fb_exact_input *middle, fb_real dt);
#endif

/* ---- one way to step: a body, a system or an exact beam, by an integrator chosen at run time */

typedef enum fb_integrator {
  FB_INTEGRATOR_RK4 = 0,
  FB_INTEGRATOR_MIDPOINT = 1,
  FB_INTEGRATOR_SDIRK = 2,
  FB_INTEGRATOR_EXPONENTIAL = 3, /* not for fb_spectrum_limit and _dt: its error does not follow from a spectrum */
  FB_INTEGRATOR_COUNT
} fb_integrator;

/* What is stepped: a body (body, state), a system (system, its models body, system_state, system_work) or an exact beam
   (exact, exact_state, exact_work). What belongs to the others stays NULL. All that the pointers name stays yours: read
   states and change inputs between the steps. */
typedef struct fb_stepper_desc {
  const fb_body *body;
  fb_state *state;
  const fb_input *input; /* NULL: nothing acts */
#if FB_WITH_SYSTEM
  const fb_system *system;
  fb_system_state *system_state;
  fb_system_work *system_work;
  const fb_system_input *system_input; /* NULL: nothing acts */
#endif
#if FB_WITH_EXACT
  const fb_exact *exact;
  fb_exact_state *exact_state;
  fb_exact_work *exact_work;
  const fb_exact_input *exact_input; /* NULL: nothing acts */
#endif
  int n_input;                       /* 1 (0): the input is held over a step; 3: an array, at t, t + dt/2 and t + dt */
  fb_integrator integrator;          /* body: any; system: rk4, SDIRK; exact beam: its own, rk4 and midpoint name it */
  const fb_exponential *exponential; /* of that integrator: from fb_exponential_init, for this body and dt */
  fb_real dt;                        /* [s] > 0 */
  int iterations;                    /* of the implicit ones, 0: 2 */
} fb_stepper_desc;

typedef struct fb_stepper {
  fb_stepper_desc desc;
  fb_real t, lost_t; /* [s] time stepped since fb_stepper_init, compensated */
  union {
    fb_rk4_work rk4;
    fb_implicit_work implicit;
    fb_exponential_work exponential;
  } work;
} fb_stepper;

/* Call it again to change the description. FB_ERR_NULL: none of the three, or one without its state and work;
   FB_ERR_UNSUPPORTED: an integrator that it does not have; what the check of that state returns; FB_ERR_VALUE: two of
   the three, dt, iterations (0..50), n_input, an exponential of another dt. */
FB_API fb_status fb_stepper_init(fb_stepper *stepper, const fb_stepper_desc *desc);
/* One step; status and failure as the step of that integrator, t is then as before. It costs what that one costs. */
FB_API fb_status fb_stepper_step(fb_stepper *stepper);

/* ---------------------------------------------------------------------------------------------------------------
   RUN >>version */

#define FB_VERSION "0.2.0"
FB_API const char *fb_version_string(void); /* "0.2.0" */
FB_API const char *fb_config_string(void);  /* the configuration symbol's name */
/* FB_OK when the caller's configuration is the implementation's: pass FB_CONFIG. */
#define FB_CONFIG FBI_STRING_(FBI_CONFIG_SYMBOL)
FB_API fb_status fb_config_check(const char *config);
/* FB_OK when the compiler has kept arithmetic as it is written: a sum is not taken in another order, a NaN is one.
   FB_ERR_BUILD: its flags let it do otherwise, and it did; compensated sums or finite checks are void. Every _init
   asks, unless FB_ALLOW_FAST_MATH is defined. No step does. */
FB_API fb_status fb_build_check(void);

#if FB_WITH_BUILD
/* ---------------------------------------------------------------------------------------------------------------
   BUILD >>eigen: dense, run-time n */

/* Eigenvalues d (n, ascending) and orthonormal eigenvectors (row k of V, n x n) of the symmetric A (n x n,
   overwritten). Off-diagonal elements below 1e-9 FB_EPSILON of the largest element count as zero. FB_ERR_NOT_FINITE;
   FB_ERR_CONVERGENCE after 60 Jacobi sweeps. */
FB_API fb_status fb_eig_sym_solve(fb_real *d, fb_real *V, fb_real *A, int n);
/* Generalized eigenproblem K x = d M x, K symmetric, M positive definite (both n x n, M is overwritten): d ascending,
   rows of X with X M X^T = 1. FB_ERR_SINGULAR: M is not positive definite; else as fb_eig_sym_solve. */
FB_API fb_status fb_eig_gen_solve(fb_real *d, fb_real *X, const fb_real *K, fb_real *M, int n);
/* Eigenvalues re + i im (n each) and eigenvectors of a real A (n x n, overwritten). Row k of X (n x 2n): eigenvector k,
   of unit length, n real then n imaginary parts; nearly parallel ones where A is defective. work: 4 n^2 reals.
   FB_ERR_NOT_FINITE; FB_ERR_CONVERGENCE after 60 n steps: re, im and X are undefined. */
FB_API fb_status fb_eig_general_solve(fb_real *re, fb_real *im, fb_real *X, fb_real *A, fb_real *work, int n);

/* ---------------------------------------------------------------------------------------------------------------
   BUILD >>beam: along its own x axis, from the root (x = 0) to the tip (x = length) */

typedef struct fb_section { /* properties at a station; between stations they vary linearly */
  fb_real x;                /* [m] from the root; ignored when there is one station (uniform beam) */
  fb_real mass;             /* [kg/m]; the beam with its lumped bodies must have some */
  fb_real EA;               /* [N] axial stiffness; 0 everywhere: inextensible, no axial modes */
  fb_real GJ;               /* [N m^2] torsional stiffness; 0: rigid */
  fb_real EI_y;             /* [N m^2] bending about y (displacement along z); 0: rigid */
  fb_real EI_z;             /* [N m^2] bending about z (displacement along y); 0: rigid */
  fb_real i_y;              /* [kg m] rotary inertia about y per length, int z^2 dm/dx; 0: none */
  fb_real i_z;            /* [kg m] rotary inertia about z per length, int y^2 dm/dx; 0: none. Without both there is no
                               polar inertia: torsion has no modes */
  fb_real GA_y, GA_z;     /* [N] shear stiffness, shear factor included; 0: rigid. Both at every station, or none */
  fb_real twist;          /* [rad] structural twist: rotation of the section axes y, z about x against the beam axes */
  fb_real mass_y, mass_z; /* [m] center of mass, to which i_y, i_z refer; offsets are in section axes */
  fb_real tension_y, tension_z; /* [m] tension center, to which EA, EI_y, EI_z refer; unused without EA */
  fb_real shear_y, shear_z;     /* [m] shear center, to which GJ, GA_y, GA_z refer; nonzero only with GA */
} fb_section;

typedef struct fb_material {
  fb_real E, G;    /* [Pa] Young's and shear modulus > 0 */
  fb_real density; /* [kg/m^3] */
} fb_material;

typedef enum fb_profile_kind { FB_PROFILE_RECTANGLE = 0, FB_PROFILE_TUBE = 1, FB_PROFILE_COUNT } fb_profile_kind;

typedef struct fb_profile { /* outline of a section */
  fb_profile_kind kind;
  fb_real x;       /* [m] from the root */
  fb_real size[2]; /* [m] rectangle: widths along y and z; tube: outer and inner radius, 0: a full circle */
} fb_profile;

/* Mass, stiffness and rotary inertia of a homogeneous section about its centroid, with the Saint-Venant torsion
   constant and Cowper's shear factor. Set GA_y = GA_z = 0 for a beam rigid in shear. FB_ERR_VALUE: a size or modulus is
   not positive (inner radius: negative, or not below the outer one); FB_ERR_NOT_FINITE. */
FB_API fb_status fb_section_init(fb_section *section, const fb_material *material, const fb_profile *profile);

typedef struct fb_lump { /* lumped body: a rigid body fixed to an element node */
  int node;              /* 0 root .. n_element tip */
  fb_real mass;          /* [kg] >= 0 */
  fb_real center[3];     /* [m] center of mass from the node, beam axes */
  fb_real inertia[6];    /* [kg m^2] about the center of mass: xx, yy, zz, xy, xz, yz (matrix elements: xy = -int xy) */
} fb_lump;

typedef enum fb_root {
  FB_ROOT_CLAMPED = 0,
  FB_ROOT_PINNED = 1, /* rotations free */
  FB_ROOT_FREE = 2,   /* of a beam that is the whole body, its hub an fb_lump, or is joined to others (fb_modes_join) */
  FB_ROOT_COUNT
} fb_root;

typedef struct fb_beam_desc {
  fb_real length; /* [m] > 0 */
  int n_element;  /* 1..FB_MAX_ELEMENTS, equal lengths */
  fb_root root;
  int n_station; /* 1 (uniform) or 2.., the first at 0, the last at length, strictly ascending */
  int n_lump;    /* 0..FB_MAX_LUMPS */
  fb_section station[FB_MAX_STATIONS];
  fb_lump lump[FB_MAX_LUMPS];
  fb_real position[3]; /* [m] root in the body frame */
  fb_real attitude[4]; /* quaternion, beam axes to body axes; all zero = identity */
  /* Curved reference line as a chain of straight elements: n_point = n_element + 1 element nodes [m] from the root on,
     beam axes, the first at 0. length is that of the chain, and x runs along it. The section axes follow the chain
     without twist: those of the first element are the beam axes rotated by the smallest rotation (less than 170
     degrees), each further element's are rotated likewise, by less than 90 degrees. Requires positive EA, GJ and EI,
     with a free root i_y and i_z, too. The second-order displacement field (E8.2) assumes small kinks. 0: straight. */
  int n_point;
  fb_real point[FB_MAX_ELEMENTS + 1][3];
} fb_beam_desc;

/* Appends n >= 2 stations of a taper whose sizes vary linearly from one profile to the other. Linear interpolation
   between the stations has the same integrals as the taper. A last station of the desc at from->x or beyond is
   replaced. FB_ERR_CAPACITY: more than FB_MAX_STATIONS; FB_ERR_VALUE: also to->x <= from->x, different kinds of
   profile; else as fb_section_init. */
FB_API fb_status fb_beam_desc_add_taper(fb_beam_desc *desc, const fb_material *material, const fb_profile *from,
                                        const fb_profile *to, int n);

typedef struct fb_beam { /* a checked desc */
  fb_beam_desc desc;
  fb_real axes[9];                         /* beam axes to body axes */
  fb_real mass;                            /* [kg] with lumped bodies */
  int has_shear;                           /* flexible in shear */
  fb_real start[FB_MAX_ELEMENTS + 1];      /* [m] x of the element nodes along the reference line */
  fb_real node[3 * (FB_MAX_ELEMENTS + 1)]; /* [m] positions of the element nodes from the root, beam axes */
  fb_real frame[9 * FB_MAX_ELEMENTS];      /* element axes to beam axes */
} fb_beam;

/* FB_ERR_VALUE, FB_ERR_NOT_FINITE, FB_ERR_CAPACITY, FB_ERR_NULL. An array of a desc
   whose count is 0 holds nothing: FB_ERR_VALUE if its first entry is filled (of points the second), for the count was
   forgotten; to drop the entries, zero them, too. So with lumps and points here, load, boundary, weld, part and its
   node, rotor, loop, spring, and support, lump and joint of exact beams. */
FB_API fb_status fb_beam_init(fb_beam *beam, const fb_beam_desc *desc);
/* Section properties at x: linear between stations, constant beyond the first and the last. */
FB_API void fb_beam_section_eval(const fb_beam *beam, fb_section *section, fb_real x);
/* Finite-element stiffness K and consistent mass M (ndof x ndof) of the unsupported beam, ndof = 6 (n_element + 1), per
   node (u_x, u_y, u_z, theta_x, theta_y, theta_z) in beam axes. Shear deformation is condensed. */
FB_API void fb_beam_matrices_eval(const fb_beam *beam, fb_real *K, fb_real *M);

/* ---------------------------------------------------------------------------------------------------------------
   BUILD >>modes: assumed modes, the Ritz basis of a beam's deformation */

/* What a mode mainly does. */
typedef enum fb_kind {
  FB_KIND_BEND_Y = 0, /* displacement along y, stiffness EI_z */
  FB_KIND_BEND_Z = 1, /* displacement along z, stiffness EI_y */
  FB_KIND_AXIAL = 2,
  FB_KIND_TORSION = 3,
  FB_KIND_COUNT
} fb_kind;

#define FB_ALL_MODES 1000 /* a count: all modes that exist (below omega_limit) */

typedef enum fb_basis {
  FB_BASIS_MODES = 0,    /* natural modes, mass-normalized (M = 1, K = omega^2) */
  FB_BASIS_ELEMENTS = 1, /* nodal coordinates of the finite elements; M and K are full */
  /* The SAME functions of x for u_x, u_y and u_z, orthonormal with respect to the mass: the basis of [DB]. With equal
     counts it is closed under rotation: a rotated deflection is again in the basis, the configuration-dependent
     (residual) inertia vanishes, and spin couples each function only with itself. Element functions with continuous
     value and slope, clamped root. */
  FB_BASIS_FUNCTIONS = 2,
  /* Hurty, Craig-Bampton: constraint modes, the static shapes of unit displacements of the boundary coordinates, then
     fixed-boundary natural modes. Exact for static loads on the boundary. */
  FB_BASIS_COMPONENT = 3,
  FB_BASIS_COUNT
} fb_basis;

typedef struct fb_coordinate { /* of an element node, beam axes */
  int node;                    /* 0 root .. n_element tip */
  int axis;                    /* 0..2 displacement along, 3..5 rotation about x, y, z */
} fb_coordinate;
#define FB_MAX_COORDINATES 24 /* boundary coordinates or load positions of a beam */

typedef struct fb_preload {  /* axial preload of a straight beam; all zero: none */
  fb_real force;             /* [N] at the tip, along x: tension is positive */
  fb_real acceleration;      /* [m/s^2] of a uniform field along x, acting on all mass: -9.81 for an upright column */
  fb_real spin, spin_radius; /* [rad/s] steady spin about an axis normal to the beam, [m] from it to the root */
} fb_preload;

typedef struct fb_modes_desc {
  fb_basis basis;
  int count[FB_KIND_COUNT]; /* lowest modes to keep per kind; FB_BASIS_ELEMENTS: nonzero keeps all of the kind */
  fb_real omega_limit;      /* [rad/s] modes above are left out; 0: no limit */
  /* Steady spin [rad/s] about an axis normal to the beam, at the distance spin_radius [m] from the clamped root; 0:
     modes at rest. Of the bending modes in each plane half are those at rest and half those under centrifugal tension,
     as Ritz modes of the unloaded beam: few of them suffice up to about that spin. One that adds to those before it
     less than 1e-4 of its amplitude (single precision: 2 %, never below some third of the first frequency) is passed
     over. */
  fb_real spin, spin_radius;
  /* FB_BASIS_FUNCTIONS: polynomial degree in an element, 3..8 (0: 3, cubic Hermite; above 5 in double precision only).
     There are (degree - 1) n_element functions in the order of the bending frequencies; count is the number to keep in
     each direction, and the coordinates are f_1 along y, z, x, then f_2 along y, z, x, and so on. root_strain = 1 adds
     a function of u_x with a slope at the root, where strain is largest: without it the axial strain is zero there,
     with it the basis is not exactly closed under rotation. */
  int degree, root_strain;
  int lowest; /* natural modes: number of lowest ones of all kinds; count is then ignored. Not with spin */
  /* Natural modes, 0..1: keeps as many modes as needed for this fraction of effective mass (of the beam without bodies
     on its root) in each direction in which the selected kinds move; count is an upper bound. Requires a clamped root.
     0: selection by count. */
  fb_real mass_fraction;
  fb_preload preload; /* modes are those under the preload, and K contains its geometric stiffness ([H] C.1): leave the
                         load itself out of the effects of the body. Not for FB_BASIS_FUNCTIONS, nor for
                         FB_EFFECT_LARGE_DEFLECTION: lines take their loads themselves */
  /* Natural modes: positions of loads whose static deflection is to be exact. Each adds a residual-flexibility
     attachment mode (static correction), the deflection under a unit load that the kept modes miss (of a free beam with
     inertia relief), orthogonal to the others. FB_ERR_MODES: they miss nothing, or nothing that has inertia. Nodes are
     those of the elements, 0 root .. n_element tip, not nodes of the body. */
  int n_load;
  fb_coordinate load[FB_MAX_COORDINATES];
  int n_boundary; /* FB_BASIS_COMPONENT */
  fb_coordinate boundary[FB_MAX_COORDINATES];
  int boundary_inertia; /* 1: FB_BASIS_COMPONENT adds the quasi-static shapes under the inertia forces of an accelerated
                           boundary (inertia-relief modes); worth more than as many natural modes. What the other
                           shapes span is not added */
  int rigid;            /* 1: the rigid-body modes of a pinned or free root come first: for components to be joined */
  /* FB_EFFECT_LARGE_DEFLECTION: points along the beam (>>line), 2 or more. 0: 7 more than the modes of the kind with
     most, at least 3 for each mode of the plane with most and 1, 4.5 for each where the beam bends in both planes or
     twists, as far as FB_MAX_POINTS holds those of one beam: shapes of 1 rad in which up to 6 modes a plane have equal
     shares are exact to 0.05 % of the length and 0.05 degrees. Where higher modes move little 5 more than modes are
     enough. Stretches between lumped bodies, kinks and steps of the sections share them, at least 3 each; the steps
     that matter most count, up to three times this number. */
  int line_points;
  int cubic; /* 1: natural modes and components of the nodal (cubic Hermite) coordinates alone, no internal shapes */
} fb_modes_desc;

typedef struct fb_modes {
  int n;      /* modes kept, ascending in frequency (equal ones in the order of the kinds) */
  int ndof;   /* length of a shape: 6 per node, then 8 internal ones per element, with shear 8 more */
  int degree; /* 0, or that of FB_BASIS_FUNCTIONS: a shape then is value and slope per node, then internal functions */
  int joined; /* 1: from fb_modes_join; 2: its welds close a loop */
  int line_points;             /* as in the desc; 0: none, modes under a preload or of buckling */
  fb_kind kind[FB_MAX_MODES];  /* by the largest share of kinetic energy */
  fb_real omega[FB_MAX_MODES]; /* [rad/s]; 0 for coordinates that are not modes */
  /* n x ndof nodal values; the main displacement of a mode at the tip is positive */
  fb_real shape[FB_MAX_MODES * FBI_MAX_DOF];
  fb_real M[FB_MAX_MODES * FB_MAX_MODES]; /* n x n */
  fb_real K[FB_MAX_MODES * FB_MAX_MODES]; /* n x n */
  /* Momentum and angular momentum about the root per unit rate of each coordinate, beam axes (n x 6); mass and moments
     of inertia of the beam about the root; and the effective mass and inertia of all coordinates together. Not for
     FB_BASIS_FUNCTIONS and joined modes. */
  fb_real momentum[6 * FB_MAX_MODES], rigid_mass[6], effective[6];
} fb_modes;

typedef struct fb_modes_work fb_modes_work; /* scratch; large: make it static */

/* Modes of a beam, without the rigid-body modes of pinned and free roots (unless desc->rigid): the body frame carries
   that motion.
     FB_ERR_KIND          a requested kind has no stiffness or no inertia
     FB_ERR_MODES         fewer modes than requested, or than mass_fraction needs; a load without a mode of its own
     FB_ERR_UNSUPPORTED   FB_BASIS_FUNCTIONS with shear, with torsion, or with root_strain but no axial functions
     FB_ERR_CAPACITY      more than FB_MAX_MODES
     FB_ERR_VALUE         also FB_BASIS_FUNCTIONS, spin or mass_fraction without a clamped root; load or boundary of
                          another basis than theirs; a preload on a curved line, or on natural modes of a root that is
                          not clamped; a coordinate that the root constrains or that is named twice
     FB_ERR_SINGULAR      the preload exceeds the buckling load, or the boundary permits rigid-body motion
     FB_ERR_CONVERGENCE */
FB_API fb_status fb_modes_solve(fb_modes *modes, fb_modes_work *work, const fb_beam *beam, const fb_modes_desc *desc);

/* Linear buckling under desc->preload: buckling shapes with, in place of omega, its load factors, ascending
   (desc->lowest of them; 0: one). Supports are the root and the coordinates of desc->boundary, such as u_y and u_z of a
   pinned tip; they must permit no rigid-body motion. FB_ERR_MODES: fewer positive factors; else as fb_modes_solve. */
FB_API fb_status fb_buckling_solve(fb_modes *modes, fb_modes_work *work, const fb_beam *beam,
                                   const fb_modes_desc *desc);

/* Component mode synthesis: components connected rigidly at nodes; their common modes are the coordinates of one
   body. */
#define FB_MAX_COMPONENTS 8
#define FB_MAX_WELDS (FB_MAX_COMPONENTS + 4)

typedef struct fb_weld { /* rigid connection of element nodes of two components, at one position in the body frame */
  int component[2], node[2];
} fb_weld;

typedef struct fb_join_desc {
  int n_weld; /* 0..FB_MAX_WELDS */
  fb_weld weld[FB_MAX_WELDS];
  int lowest;          /* number of common modes to keep; 0: all */
  fb_real omega_limit; /* [rad/s] modes above are left out; 0: no limit */
} fb_join_desc;

typedef struct fb_join_work fb_join_work; /* scratch; large: make it static */

/* Common modes of components connected rigidly at nodes, without the rigid-body modes of the whole. joined, beam and
   component are arrays of n_component; joined may be component. joined[k].M and K are the contribution of component k.
     Components   one that is attached to another has a free root and rigid-body modes (fb_modes_desc.rigid), or all
                  coordinates of FB_BASIS_ELEMENTS, or its root in the boundary; a clamped root stays fixed to the body
                  frame. Natural modes alone converge slowly at a weld: add attachment modes there (load), or make its
                  node a boundary. Motion of a weld that one side does not have in its basis is locked on both.
     Welds        redundant ones do no harm. Those that close a loop are kept to first degree in the coordinates, which
                  FB_EFFECT_LARGE_DEFLECTION refuses (joined = 2): close such loops by joints of a system.
     Shape        with n = joined->n and first = 0 of all parts add beam 0, a node at each of its welds, then the beams
                  attached there by their roots, whose second-order displacement continues from that node, and so on.
   FB_ERR_CONVERGENCE: slow elastic modes look like rigid-body modes in this precision (keep fewer, or use double);
   FB_ERR_CAPACITY: counts, a node, more than FB_MAX_MODES; FB_ERR_VALUE: nodes of a weld more than 1e-4 of the beams'
   length apart, FB_BASIS_FUNCTIONS; FB_ERR_MODES: fewer modes than requested; FB_ERR_SINGULAR: a coordinate without
   mass. */
FB_API fb_status fb_modes_join(fb_modes *joined, fb_join_work *work, const fb_beam *beam, const fb_modes *component,
                               const fb_join_desc *desc, int n_component);

/* ---------------------------------------------------------------------------------------------------------------
   BUILD >>assemble: shape integrals; every _init of a model */

typedef struct fb_second { /* shape integrals of second degree, and what the modes move at most */
  fb_real ups[3 * FB_MAX_MODES * FB_MAX_MODES];
  fb_real Gam[9 * FB_MAX_MODES], Pi[9 * FB_MAX_MODES * FB_MAX_MODES];
  fb_real Gamchi[9 * FB_MAX_MODES * FB_MAX_MODES];
  fb_real pchi[3 * FB_MAX_MODES * FB_MAX_MODES], hchi[3 * FB_MAX_MODES * FB_MAX_MODES];
  fb_real reach[FB_MAX_MODES]; /* largest displacement of each mode shape */
} fb_second;

/* Inertia shape integrals over the undeformed body, M and K; built once, not used by the step. */
typedef struct fb_shape {
  int n;      /* elastic coordinates */
  int n_node; /* nodes, node 0 included */
  fb_real mass, c[3], J[9];
  fb_real P[3 * FB_MAX_MODES], H[3 * FB_MAX_MODES]; /* n x 3 here: row a is p_a, h_a */
  fb_real M[FB_MAX_MODES * FB_MAX_MODES], K[FB_MAX_MODES * FB_MAX_MODES];
  fb_second second; /* of all of the body */
#if FB_WITH_NONLINEAR_STRAIN
  int n_strain;                           /* quadrature points of the axial strain, a multiple of four */
  fb_real stretch;                        /* [s^2] bound of the centrifugal strain of a beam per spin squared */
  fb_real strain_weight[FBI_MAX_STRAINS]; /* [N m] EA dx */
  fb_real slope[3 * FB_MAX_MODES * FBI_MAX_STRAINS]; /* n x 3 x FBI_MAX_STRAINS: u_x', u_y', u_z' in beam axes */
#endif
#if FB_WITH_LARGE_DEFLECTION
  fb_lines lines;         /* of the beams */
  fb_status lines_status; /* why a beam has none: FB_EFFECT_LARGE_DEFLECTION is then refused with it. FB_ERR_CAPACITY:
                             points, lines; FB_ERR_KIND: a joined beam hangs where no point is
                             (a lumped body there makes one, also of no mass); FB_ERR_VALUE: points
                             that miss 5 % of a beam's first or second moment of mass about its root, more are needed
                             (line_points); FB_ERR_UNSUPPORTED: modes under a preload or of buckling, welds that close
                             a loop, two beams in one place */
  fb_second rest;         /* as `second`, of all but the beams */
#endif
  fb_real size; /* [m] largest distance of a mass from O */
  fb_node node[FB_MAX_NODES];
} fb_shape;

/* How the modes move a point: displacement and rotation, linear (n x 3) and quadratic (n x n x 3), body axes. */
typedef struct fb_fields {
  fb_real r[3]; /* [m] of the undeformed body */
  fb_real u[3 * FB_MAX_MODES], theta[3 * FB_MAX_MODES];
  fb_real chi[3 * FB_MAX_MODES * FB_MAX_MODES], chi_theta[3 * FB_MAX_MODES * FB_MAX_MODES];
} fb_fields;

/* An empty body with n elastic coordinates and node 0. FB_ERR_CAPACITY, FB_ERR_NULL. */
FB_API fb_status fb_shape_init(fb_shape *shape, int n);
/* Adds a point mass [kg] at r [m] with displacement shapes psi (n x 3) and second-order displacements chi (n x n x 3,
   symmetric in the modes, or NULL). */
FB_API fb_status fb_shape_add_particle(fb_shape *shape, fb_real mass, const fb_real r[3], const fb_real *psi,
                                       const fb_real *chi);
/* Adds a rigid body fixed to the body frame: mass [kg], center of mass [m], inertia about it [kg m^2] (xx, yy, zz, xy,
   xz, yz). */
FB_API fb_status fb_shape_add_rigid(fb_shape *shape, fb_real mass, const fb_real center[3], const fb_real inertia[6]);
/* Import of a finite-element model, part by part, in body axes. Set shape->K yourself: for modes omega^2 times shape->M
   on the diagonal.
     fb_shape_add_lump   mass of a node: lumped mass [kg], inertia [kg m^2] about the node (xx, yy, zz, xy, xz, yz;
                         NULL: none), displacement and rotation shapes psi, theta (n x 3)
     fb_shape_add_node   a node for loads and sensors
     fb_shape_add_pair   integrals of the second-order displacement of coordinates a and b, symmetric in them: p^chi
                         [kg/m], h^chi, Gamma^chi 3 x 3 [kg]; NULL: none
   With FB_EFFECT_LARGE_DEFLECTION not for coordinates of a beam, which such shapes do not follow far: take
   fb_beam_desc.lump, fb_shape_add_beam_node. Errors as fb_shape_add_particle; FB_ERR_CAPACITY: nodes, coordinates. */
FB_API fb_status fb_shape_add_lump(fb_shape *shape, fb_real mass, const fb_real r[3], const fb_real *inertia,
                                   const fb_real *psi, const fb_real *theta);
FB_API fb_status fb_shape_add_node(fb_shape *shape, int *node, const fb_real r[3], const fb_real *psi,
                                   const fb_real *theta);
FB_API fb_status fb_shape_add_pair(fb_shape *shape, int a, int b, const fb_real *pchi, const fb_real *hchi,
                                   const fb_real *Gamchi);
/* Effects of second degree (stiffening by spin and acceleration) of any imported part, from a finite-element program:
   the geometric stiffness K_G of coordinates a and b, once for each a >= b, from stresses under inertia loads of a frame
     acceleration[3]   that accelerates by 1 m/s^2 along x, y, z (a gravity of -1 m/s^2 is the same load)
     turn[3]           whose angular acceleration is 1 rad/s^2 about x, y, z
     spin[6]           that spins with w: K_G = s0 w_x^2 + s1 w_y^2 + s2 w_z^2 + s3 w_x w_y + s4 w_x w_z + s5 w_y w_z
   in [kg/m] and [kg] of modes without a unit. Forces at nodes do not stiffen such parts. */
FB_API fb_status fb_shape_add_stiffening(fb_shape *shape, int a, int b, const fb_real acceleration[3],
                                         const fb_real turn[3], const fb_real spin[6]);
/* The same effects of line-like parts (masts, booms, frames; a panel that hangs on a mast is a line of two points),
   from the shapes alone, as lines keep their length. fb_fields_init finds the fields of a point at r [m] from those of
   the point before it, from (NULL: the first one, whose quadratic fields are zero, as at an interface); theta NULL: a
   model without rotations, lines are straight from point to point. Then add masses and nodes by fb_shape_add_field_lump
   and fb_shape_add_field_node. Errors as fb_shape_add_lump; FB_ERR_VALUE: a point on the one before it. */
FB_API fb_status fb_fields_init(fb_fields *fields, const fb_shape *shape, const fb_fields *from, const fb_real r[3],
                                const fb_real *psi, const fb_real *theta);
FB_API fb_status fb_shape_add_field_lump(fb_shape *shape, const fb_fields *fields, fb_real mass,
                                         const fb_real *inertia);
FB_API fb_status fb_shape_add_field_node(fb_shape *shape, int *node, const fb_fields *fields);
/* Adds a beam with its modes as coordinates first .. first + modes->n - 1: all integrals, M and K. If its root moves
   with the modes, the second-order displacement continues from the node of the shape that has the same position and
   motion (fb_modes_join); without such a node joined modes are refused (FB_ERR_VALUE). */
FB_API fb_status fb_shape_add_beam(fb_shape *shape, int first, const fb_beam *beam, const fb_modes *modes);
/* Adds a node on that beam at x [m] from the root; *node is its number. For FB_EFFECT_LARGE_DEFLECTION after the beam:
   fb_body_init refuses nodes that move with a beam otherwise (FB_ERR_EFFECTS). */
FB_API fb_status fb_shape_add_beam_node(fb_shape *shape, int *node, int first, const fb_beam *beam,
                                        const fb_modes *modes, fb_real x);
/* Strain gauge along that beam (coordinates from first on) at x [m] from the root and y, z [m] off the reference line,
   beam axes: linear strain. Errors as fb_shape_add_beam_node. With natural modes strains converge more slowly than
   displacements: keep more modes, or add attachment modes for the loads (fb_modes_desc.load). */
FB_API fb_status fb_gauge_init(fb_gauge *gauge, int first, const fb_beam *beam, const fb_modes *modes, fb_real x,
                               fb_real y, fb_real z);

#if FB_WITH_NONLINEAR_STRAIN
/* Adds the quadrature points of the axial strain of that beam, once per beam, for FB_EFFECT_NONLINEAR_STRAIN: 2 degree
   - 1 an element (cubic functions: 5; natural modes: 9), so that the strain energy is exact, per beam up to the next
   multiple of four. Axial coordinates that cannot represent the foreshortening make the beam too stiff (membrane
   locking): take FB_BASIS_FUNCTIONS with as many axial as bending functions (error of the deflection in the spin-up:
   one cubic element 29 %, two 4 %, three 0.4 %), not natural modes. FB_ERR_CAPACITY: more than FB_MAX_STRAINS;
   FB_ERR_KIND: EA is zero somewhere; else as fb_shape_add_beam. */
FB_API fb_status fb_shape_add_beam_strain(fb_shape *shape, int first, const fb_beam *beam, const fb_modes *modes);
#endif

typedef enum fb_truncation {
  FB_TRUNCATE_NONE = 0,
  FB_TRUNCATE_ABOVE_0 = 1, /* [DB] Q = 0 */
  FB_TRUNCATE_ABOVE_1 = 2, /* Q = 1: the strain energy is not bounded below, the motion diverges */
  FB_TRUNCATE_ABOVE_2 = 3, /* Q = 2 */
  FB_TRUNCATE_COUNT
} fb_truncation;

typedef struct fb_body_desc {
  unsigned effects; /* FB_EFFECT_... or-ed; 0: rigid body */
  fb_base base;
  /* Damping ratio of each mode (for a general M: of the k-th mode by frequency) as the basis has it: of a clamped root
     with the frame held. On a hub that moves, a mode of frequency omega then has about zeta omega / omega_held, which
     fb_body_spectrum_solve tells. Must be zero without FB_EFFECT_DAMPING (FB_ERR_EFFECTS) */
  fb_real zeta[FB_MAX_MODES];
  fb_real gravity[3]; /* [m/s^2] inertial axes; must be zero without FB_EFFECT_GRAVITY (FB_ERR_EFFECTS) */
  /* Gravity of a center, beside that: mu [m^3/s^2] (G times its mass; 0: none), the center [m] in inertial axes. Force,
     gravity-gradient torque and modal forces are those of the field to second degree about the mass center of the
     deformed body; what is left out is, relative to them, about its size over the distance. FB_ERR_RANGE: the mass
     center is nearer to the center than twice the root mean square distance of the body's mass from it. With rigid
     bodies, FB_EFFECTS_FULL, _STRAIN or _LARGE; not with advice and internal loads of lines. In systems only
     in double precision, and not in trim, linear models and spectra (FB_ERR_UNSUPPORTED). */
  fb_real mu, center[3];
  /* [m] Limit of the sum of modal deflections, FB_ERR_RANGE beyond it; 0: half the body's size. The error of the
     quadratic displacement field is 0.1 % (held root) to 1 % (light hub) at deflections of 6 % of the length, some
     percent at 15 %. Of FB_EFFECTS_LARGE a limit of the modes in which no beam bends. */
  fb_real deflection_limit;
  /* Leaves out terms of a higher degree in q (bracketed superscript in [DB]) than this, to study their influence as in
     [DB] Figures 4 and 5: terms of the stiffness, of the stiffness torque and, in the second-order form, of the
     inertia. Requires allow_split_effects. */
  fb_truncation truncation;
#if FB_WITH_ROTORS
  int n_rotor;
  fb_rotor rotor[FB_MAX_ROTORS];
#endif
  int allow_split_effects; /* 1: accept an incomplete set of effects, which fb_effects_check refuses */
  int allow_long_step;     /* 1: accept steps beyond the stability limit */
} fb_body_desc;

typedef struct fb_body_work fb_body_work; /* scratch */

/* The model of a body from its shape integrals.
     FB_ERR_CAPACITY    FB_MAX_LAMBDA, FB_MAX_S; number or node of a rotor
     FB_ERR_EFFECTS     see fb_effects_check; large deflection: a node that moves with a beam but was added before it or
                        by fb_shape_add_node, or such a mass (fb_shape_add_particle, _lump, _pair); mu with modes but
                        without inertia that follows the shape; FB_EFFECT_ROTORS without any
     FB_ERR_SINGULAR    M, or S_0 of a free or pinned body, which needs inertia about every axis: 1e-12 of the largest,
                        in single precision 1e-5
     FB_ERR_VALUE       no mass, negative damping, negative mu; of a rotor: axis of no length, inertia not above 0,
                        friction without friction_speed, what is negative
     FB_ERR_NOT_FINITE; large deflection: lines_status of the shape */
FB_API fb_status fb_body_init(fb_body *body, fb_body_work *work, const fb_shape *shape, const fb_body_desc *desc);

/* Factors of what a body that is built is made of, {1, 1, 1, 1, 1}: as it is. The modes keep their shapes and q its unit, displacements are those of
   the same q. */
typedef struct fb_body_factors {
  fb_real stiffness;   /* of K, above 0; what preload or a spin adds to it included */
  fb_real damping;     /* of the damping ratios */
  fb_real mass;        /* of all but the hub, above 0 */
  fb_real hub_mass;    /* of the hub, whose mass center stays */
  fb_real hub_inertia; /* of the hub, about its mass center */
  /* The hub as the body was built with it, all zero: none. */
  fb_real hub;        /* [kg] its mass */
  fb_real center[3];  /* [m] its mass center, body axes */
  fb_real inertia[6]; /* [kg m^2] about that: xx yy zz xy xz yz */
} fb_body_factors;

/* A body by factors of another one, `from`, which may be itself: without building it anew, what a parameter study, an
   identification or an adaptive filter wants. To rounding it is the body whose description has those factors, but for the
   bounds of the stiffening by a hub of another factor, which are not below: fb_rk4_limit may be shorter. Shapes of modes at
   rest do not depend on these factors; those under preload or a spin do (fb_modes_desc). In systems: before fb_system_init.
     FB_ERR_VALUE        a factor negative, or 0 where it is to be above; factors of a hub without one; a hub of more mass
                         than the body
     FB_ERR_UNSUPPORTED  factors of masses of a body with FB_EFFECT_LARGE_DEFLECTION or rotors
     FB_ERR_SINGULAR     S_0 of a free or pinned body is not positive definite: less of the hub than there can be
     FB_ERR_NOT_FINITE */
FB_API fb_status fb_body_scale(fb_body *body, fb_body_work *work, const fb_body *from, const fb_body_factors *by);

/* Builds a body of a rigid hub, beams on it or joined to each other, and nodes from one description: fb_beam_init,
   fb_modes_solve, fb_modes_join, fb_shape_... and fb_body_init in one call. Imported finite-element models need these
   calls one by one. */
#define FB_MAX_PARTS FB_MAX_COMPONENTS
typedef struct fb_part {
  int beam;                   /* index in the arrays of beam and modes descriptions; parts may share one */
  fb_real position[3];        /* [m] origin of the beam description, body axes */
  fb_real attitude[4];        /* quaternion, axes of that description to body axes, normalized; all zero: identity */
  int n_node;                 /* nodes along the beam, numbered after those of the parts before; the first one is 1 */
  fb_real node[FB_MAX_NODES]; /* [m] from the root */
} fb_part;

typedef struct fb_build_desc {
  fb_real mass, center[3], inertia[6]; /* hub [kg], [m], [kg m^2] about its center; all 0: none */
  int n_part;                          /* 0..FB_MAX_PARTS */
  fb_part part[FB_MAX_PARTS];          /* their modes are the coordinates of the body, in this order */
  /* Rigid connections between parts (weld.component: a part), as fb_modes_join: the common modes of all parts are then
     the coordinates. A part attached to another one follows it in the list, and that one has a node at the weld. All
     zero: not joined */
  fb_join_desc join;
  fb_real zeta; /* damping ratio of all modes (see fb_body_desc.zeta), with FB_EFFECT_DAMPING; 0: body.zeta */
  fb_body_desc body;
} fb_build_desc;

/* Scratch; large: make it static. .part: after a failure the part that failed; -1: the hub, n_part: joining, the body as a
   whole. */
typedef struct fb_build_work fb_build_work;

/* beam, modes: n_beam beam descriptions, and the modes to keep of each. FB_ERR_CAPACITY: n_part, n_node, an index from
   n_beam on, more than FB_MAX_MODES coordinates or FB_MAX_NODES nodes; FB_ERR_VALUE: both zeta and body.zeta are set;
   no node where a part is attached; a weld at a clamped root, which is fixed to the frame; natural modes of a pinned
   root without rigid (fb_modes_desc); a free root without a weld, or its natural modes without rigid. A part that is
   the whole body needs neither weld nor rigid. Else as the functions it calls. */
FB_API fb_status fb_body_build(fb_body *body, fb_build_work *work, const fb_build_desc *desc, const fb_beam_desc *beam,
                               const fb_modes_desc *modes, int n_beam);

#if FB_WITH_SYSTEM
typedef struct fb_joint_desc {
  fb_joint_kind kind;
  int parent, parent_node; /* body (default 0) or FB_GROUND; one of its nodes (of the ground: 0) */
  int child, child_node;   /* loops only: a joint of the tree carries its own body at node 0 and child_position */
  fb_real position[3];     /* [m] joint frame on the parent, relative to the node in the axes of its section */
  fb_real attitude[4];     /* quaternion, joint axes to section axes, normalized; all zero: identity */
  fb_real child_position[3], child_attitude[4]; /* joint frame on the child; both coincide at zero coordinates */
  fb_real pitch;                                /* [m/rad] screw */
  fb_axis_mode mode[3]; /* initial mode of each axis; spherical and free: mode[0] applies to all */
  /* [N m/rad, N/m], [rad, m], [N m s/rad, N s/m]; spherical: the first applies to all, rest is zero. Free, a body on
     moorings: of O along x, y, z of the ground, then of the rotation vector of the body's attitude, energy
     k (theta_i - rest_i)^2/2 each; dampers of the velocity of O along x, y, z of the ground, then of w about the axes of
     the body (E9.30). FB_ERR_RANGE: springs of the rotation at 3.1 rad, since the rotation vector jumps at pi; a joint
     frame or axis beside them is refused */
  fb_real stiffness[6], rest[6], damping[6];
  /* Friction, E9.28: Coulomb's [N m, N], regularized. It has 71 % of its size at friction_speed [rad/s, m/s], positive
     where there is friction; below it is a damper, so that a joint under load creeps. Stops, E9.29: springs [N m/rad,
     N/m] beyond the values stop[i][0] and stop[i][1] [rad, m], the higher second; stop_loss c [s/rad, s/m]: an impact
     at the speed v comes back with about (1 - 2/3 c v) v. stop_stiffness zero: no stops. Neither on spherical and free
     joints; stops about the axes of joints of loops within half a turn */
  fb_real friction[3], friction_speed[3], stop[3][2], stop_stiffness[3], stop_loss[3];
  /* In place of attitude and child_attitude, which are then zero: the joint's z axis, about which or along which it
     moves, in axes of the parent and of the child, of any length. The joint axes are those of the body rotated by the
     smallest rotation that takes z there. child_axis (and child_attitude) all zero: as axis, so that the axes of both
     bodies coincide at zero coordinates */
  fb_real axis[3], child_axis[3];
} fb_joint_desc;

typedef struct fb_system_desc {
  int n_body;
  int model[FB_MAX_BODIES]; /* index of each body in the array of models; bodies may share one. FB_ERR_VALUE: with as
                                         many models as bodies, one is not used */
  fb_joint_desc joint[FB_MAX_BODIES]; /* joint k connects body k to its parent, an earlier body or the ground */
  int n_loop;
  fb_joint_desc loop[FB_MAX_LOOPS]; /* joints that close loops between bodies of the tree, or one and the ground */
  int n_spring;
  fb_spring spring[FB_MAX_SPRINGS];
  fb_method method;
  int allow_long_step; /* 1: accept steps beyond the stability limit */
} fb_system_desc;

/* work->joint is the joint that failed.
     FB_ERR_VALUE         a parent that is not an earlier body; both axis and attitude on one side; a free joint as loop
                          or with friction or stops; friction or stops of a spherical joint; friction without
                          friction_speed; stops out of order; negative stiffness, damping or length; a spring with both
                          ends on the ground; an invalid mode, form or base of a body
     FB_ERR_CAPACITY      numbers of bodies, loops, springs, models, nodes
     FB_ERR_UNSUPPORTED   a body with central gravity in single precision
     FB_ERR_SINGULAR      the mass matrix of the undeformed system at zero coordinates */
FB_API fb_status fb_system_init(fb_system *system, fb_system_work *work, const fb_body *body,
                                const fb_system_desc *desc, int n_model);
#endif

#if FB_WITH_EXACT
typedef struct fb_exact_station { /* section of the undeformed beam; linear between stations */
  fb_real x;                      /* [m] along the reference line, from 0; ignored for one station (uniform) */
  /* 6x6, symmetric, (force; moment) by (force strain; curvature), section axes, x along the line: [N], [N m], [N m^2].
     A zero on the diagonal: rigid in that strain, its row and column are ignored. Support the root, not the tip, in a
     rigid direction */
  fb_real stiffness[36];
  fb_real inertia[36];  /* 6x6, (momentum; angular momentum) by (velocity; angular velocity): [kg/m], [kg], [kg m]; may
                          be 0 */
  fb_real twist;        /* [rad] rotation of the section axes about x, relative to the axes that the curvature gives */
  fb_real curvature[3]; /* [rad/m] initial curvature of the reference line, in section axes */
} fb_exact_station;

/* Stiffness and inertia matrices of a section from its engineering properties, with centers off the reference line,
   shear and rotary inertia; x and twist are copied. Zero stiffness: rigid. FB_ERR_VALUE, FB_ERR_NOT_FINITE. */
FB_API fb_status fb_exact_station_init(fb_exact_station *station, const fb_section *section);

typedef struct fb_support {
  int node, held; /* node and its constrained components: FB_HOLD_... or-ed, or FB_END_... */
} fb_support;

/* Further chain of elements, which begins at a node: a hub with several booms, a T, a frame, rotor blades. Its elements and
   nodes are numbered on from those before it: its element k has the nodes k + 1 outboard and, inboard, k or for its first
   element `node`. Its line begins there with the section axes of the node; with an attitude it stands at an angle: its
   first element is then a joint of no length, driven and at rest, numbered after the joints of the desc in the order of the
   branches, and its sections have the twist of its stations relative to that attitude. Its tip is free; supports hold
   it. */
typedef struct fb_exact_branch {
  int node;               /* of the chain, or of an earlier branch */
  int n_element;          /* with that joint */
  int station, n_station; /* its own among desc.station, x from its begin; n_station 0: those of the chain */
  fb_real length;         /* [m]; 0: that of the chain */
  fb_real attitude[4];    /* its root's section axes before twist to those of the node; all zero: no joint */
} fb_exact_branch;

typedef struct fb_exact_desc {
  fb_real length;     /* [m] along the line > 0 */
  int n_element;      /* of the chain; with those of all branches 1..FB_MAX_EXACT; nodes are 0 root .. n_element tip. An
                         element of length h bears the tension 12 EI/h^2: from there (many elements) to twice that (one)
                         on its flexibility h^2/(12 EI) across (E10.6) buckles, steady states are unstable
                         (work->unstable) and wrong, motions leave them; tethers and fast rotors want elements shorter
                         than sqrt(12 EI/tension) */
  int n_station;      /* 1 or 2..FB_MAX_STATIONS, the first at 0, the last at length, ascending */
  int root, tip;      /* FB_END_... */
  int n_support;      /* further nodes that are supported */
  int n_lump;         /* lumped bodies on nodes, in section axes there */
  int n_joint;        /* elements that are joints */
  int n_branch;       /* further chains */
  int iterations;     /* Newton iterations of a time step, at most, 1..20; 0: 6 */
  int factorizations; /* of a step, 1..20, each further one with an iteration of its own; 0: 1, see fb_exact_step */
  int box; /* nonzero: mass that moves along the line and rotary inertia about it stay in the middle of the elements, as
              in the box scheme of [L], where waves of stretch and of twist of a straight beam travel without error in
              steps of dx/c. For bases that do not translate: where elements bend by theta, the inertia of translation
              is off by theta^2/12, and a steady state with v goes on with that error */
  fb_real
      place[FB_MAX_EXACT + 1]; /* [m] x of the nodes along the line, ascending from 0 to length, equal at both ends of a
                       joint; all 0: equal elements, joints of length zero between them. The same of each branch, the
                       nodes beyond the one that it begins at */
  fb_exact_station station[FB_MAX_STATIONS];
  fb_support support[FB_MAX_LUMPS];
  fb_lump lump[FB_MAX_LUMPS];
  fb_exact_joint joint[FB_MAX_LUMPS];
  fb_exact_branch branch[FB_MAX_LUMPS];
  fb_real position[3], attitude[4]; /* root in the base frame [m], section axes before
                                       their twist to base axes; all zero: identity */
  fb_real gravity[3];               /* [m/s^2] inertial axes */
  /* Numerical dissipation 1 - rho_infinity, 0 (energy is conserved) to 2/3: the part by which a step reduces
     oscillations much faster than it resolves. The order remains 2: a resolved oscillation gets the damping ratio
     beta (omega dt)^3/4, beta = rho (1 - rho)/(1 + rho)^2, at most 1/8. */
  fb_real dissipation;
  /* Structural damping [s] >= 0, in proportion to the stiffness: mu of stretch, shear along y and z, torsion, bending
     about y and z. Stress = stiffness strain + D strain_t, D_ij = sqrt(mu_i mu_j) stiffness_ij; all equal to mu: a mode
     of the frequency omega has the damping ratio mu omega/2. Shear that is rigid takes that of the bending in its plane,
     values of what else is rigid are not used. In single precision steps below some mu/1000 may not converge.
     FB_ERR_VALUE, the beam is then empty: unequal where a direction is rigid that is no axis (one bending, of a line
     that is twisted) */
  fb_real damping[6];
} fb_exact_desc;

/* FB_ERR_VALUE: also a stiffness that is not positive definite in the directions that are not rigid, a direction that
   is rigid at some stations only, an inertia that is not positive semidefinite; FB_ERR_CAPACITY; FB_ERR_NOT_FINITE;
   FB_ERR_NULL. Also joints: FB_ERR_VALUE: an element that is two joints, elements that are all joints, a node held
   outboard of a joint (the elimination from the tip would find its five rigid directions held at both ends: hold the
   node inboard of it), an axis too short, places that differ. */
FB_API fb_status fb_exact_init(fb_exact *exact, const fb_exact_desc *desc);
#endif

/* Coefficients of fb_exponential_step for the step dt [s]. FB_ERR_VALUE: dt; FB_ERR_SINGULAR: K or the mass matrix is not positive definite; FB_ERR_EFFECTS: nonlinear strain with
   axial coordinates that also bend. */
FB_API fb_status fb_exponential_init(fb_exponential *scheme, fb_body_work *work, const fb_body *body, fb_real dt);

/* Copies the shape with the modes coordinate[0..n-1] (ascending) alone. Meant for natural modes; of other bases the
   coordinates left out are constrained to zero. FB_ERR_CAPACITY: more than shape has; FB_ERR_VALUE: not ascending.
   selected may not be shape. */
FB_API fb_status fb_shape_select(fb_shape *selected, const fb_shape *shape, const int *coordinate, int n);

#if FB_WITH_FORMS
/* ---------------------------------------------------------------------------------------------------------------
   BUILD >>forms: a body by the equations of motion of [DB], for comparison with the momentum form. Not for flight: it
   has no ROM text, no systems and no analysis */

typedef enum fb_form {
  FB_FORM_MOMENTUM = 0, /* the functions of bodies: fb_rk4_step, fb_body_motion_eval, .. */
  FB_FORM_SECOND = 1,   /* [DB] (7)-(8): velocities and q_dot; a mass matrix that follows the shape, factored at every
                           evaluation */
  FB_FORM_FIRST = 2,    /* [DB] (23)-(25): velocities and elastic velocities v_e, a constant mass matrix, a stiffness
                           torque. It has no inertia that follows the shape (FB_EFFECT_RESIDUAL_INERTIA adds nothing) and
                           no quadratic field */
  FB_FORM_COUNT
} fb_form;

/* The stiffness torque K_re q of the first-order form. The frame and the beam exchange energy through it: one that
   does not fit the elastic forces lets energy leak. All are the same on a rotation-closed basis. */
typedef enum fb_stiffness_torque {
  FB_TORQUE_IDENTITY = 0, /* [DB] (49), q_b Upsilon_b M^-1 dU/dq: energy-exact on every basis */
  FB_TORQUE_PRINTED = 1,  /* [DB] (34)-(36): wrong where u_x' is free at the root, and refinement does not mend it */
  FB_TORQUE_BOUNDARY = 2, /* (36) with the boundary term - u_x'(0) EI u_y''(0) that its integration by parts leaves */
  FB_TORQUE_COUNT
} fb_stiffness_torque;

/* Bilinear part of the stiffness torque as printed, and the boundary term missing there, n x n x 3; all zero before the
   first beam. unknown: 1 if they are not complete, which they are only for beams along x with FB_BASIS_FUNCTIONS. */
typedef struct fb_form_torque {
  int n, n_beam, unknown;
  fb_real inside[3 * FB_MAX_MODES * FB_MAX_MODES], boundary[3 * FB_MAX_MODES * FB_MAX_MODES];
} fb_form_torque;

typedef struct fb_form_desc {
  fb_form form;
  fb_stiffness_torque stiffness_torque; /* of the first-order form */
  const fb_form_torque *torque; /* needed by FB_TORQUE_PRINTED and FB_TORQUE_BOUNDARY, of all beams of the shape */
} fb_form_desc;

typedef struct fb_form_body {
  fb_body body; /* nodes, sizes, step limits; of the second-order form S is M_rr(q): it moves by the functions below */
  fb_form form;
  fb_stiffness_torque stiffness_torque;
  int degree;          /* 3, or what truncation leaves */
  int n_S, n_lambda;   /* second-order form: those in the mass matrix, the others of body in its rates alone */
  int n_gam, n_torque; /* first-order form */
  fb_real M_rr[21];    /* rigid mass matrix of the undeformed body */
  fb_lambda_term gam[9 * FB_MAX_MODES];                   /* Gamma_a, element i of 9 */
  fb_lambda_term torque[3 * FB_MAX_MODES * FB_MAX_MODES]; /* stiffness torque, element i of 3, bilinear in q_a q_b */
} fb_form_body;

typedef struct fb_form_work fb_form_work; /* scratch */

/* Adds a beam that fb_shape_add_beam_strain has added. Statuses as of that. */
FB_API fb_status fb_form_torque_add_beam(fb_form_torque *torque, const fb_shape *shape, int first, const fb_beam *beam,
                                         const fb_modes *modes);

/* As fb_body_init. FB_ERR_EFFECTS: also, but for the momentum form, large deflection, rotors, central gravity; second
   order: one of spin coupling and residual inertia; first order: the quadratic field, or a printed torque that is not
   known. */
FB_API fb_status fb_form_init(fb_form_body *formed, fb_body_work *work, const fb_shape *shape, const fb_body_desc *desc,
                              const fb_form_desc *form);
/* As fb_body_check and fb_body_crc, with the tables of the form. */
FB_API fb_status fb_form_check(const fb_form_body *formed);
FB_API unsigned fb_form_crc(const fb_form_body *formed);

/* As fb_state_from_velocity and fb_body_.._eval. fb_state_init and fb_state_check with formed->body. In the two other
   forms state.u is the velocity of O, inertial axes, and state.L the angular velocity, body axes, both zero of a
   prescribed base; state.pi is q_dot or v_e. fb_body_node_motion_eval takes a state and a motion of any form. */
FB_API fb_status fb_form_state_from_velocity(const fb_form_body *formed, fb_state *state, const fb_real v[3],
                                             const fb_real w[3], const fb_real *q_dot);
FB_API fb_status fb_form_rates_eval(const fb_form_body *formed, fb_state *rate, const fb_state *state,
                                    const fb_input *input);
FB_API fb_status fb_form_motion_eval(const fb_form_body *formed, fb_motion *motion, const fb_state *state,
                                     const fb_input *input);
FB_API fb_status fb_form_energy_eval(const fb_form_body *formed, fb_energy *energy, const fb_state *state,
                                     const fb_input *input);
FB_API fb_status fb_form_momentum_eval(const fb_form_body *formed, fb_momentum *momentum, const fb_state *state,
                                       const fb_input *input);

/* A step by FB_INTEGRATOR_RK4, _MIDPOINT or _SDIRK with the limits and statuses of fb_rk4_step, fb_midpoint_step (takes
   the input at the middle), fb_sdirk_step (start and end); iterations: of the latter two. In the two other forms their
   matrix lacks gyroscopic terms and stiffness torque. FB_ERR_VALUE: another integrator. */
FB_API fb_status fb_form_step(const fb_form_body *formed, fb_state *state, fb_form_work *work, fb_integrator integrator,
                              const fb_input *start, const fb_input *middle, const fb_input *end, fb_real dt,
                              int iterations);
#endif

#endif /* FB_WITH_BUILD */

#if FB_WITH_ANALYSE
/* ---------------------------------------------------------------------------------------------------------------
   ANALYSE >>trim: steady states; offline work on bodies, systems and the geometrically exact beam */

#if FB_WITH_EXACT
/* Steady state under constant loads, gravity and motion of the base (at rest or in steady rotation; loads that do not
   rotate with a spinning base are taken in their present direction). state is the first guess; if Newton's method does
   not converge from it, load increments are applied to the undeformed beam, and increments of the way of its supports
   under the first of them, straight there: so slack lines (moorings, cables), built straight, get to their ends. Where
   that way would buckle go another from state to state. At most 500 increments of 25 iterations.
   A driven joint keeps the angle of the state, which may be set; the undeformed beam has its joints at those angles.
   Beyond a buckling load there are several steady states. work->unstable is the number of unstable directions of this
   one, the negative eigenvalues of the tangent stiffness (E10.20): 0 is stable, k > 0 as where k buckling loads are
   exceeded. For dead loads, gravity and loads that rotate with the base this is the criterion of Lagrange and
   Dirichlet. With follower loads it detects divergence but not flutter, and it ignores gyroscopic stabilization by a
   spinning base: use fb_exact_spectrum_solve. To reach the stable state beyond buckling, or a state beyond a limit
   point, use fb_exact_path_step.
   FB_ERR_CONVERGENCE; FB_ERR_SINGULAR: not supported, or at a limit point; FB_ERR_CAPACITY: a node that does not exist;
   FB_ERR_VALUE; FB_ERR_NOT_FINITE. On failure state is unchanged. */
FB_API fb_status fb_exact_trim(const fb_exact *exact, fb_exact_state *state, fb_exact_work *work,
                               const fb_exact_input *input);
#endif

/* Maximum number of states of a linear model: of one body, or of a system with the capacity of FB_METHOD_DENSE. */
#define FB_MAX_LINEAR (2 * (FBI_MAX_COORDINATES + 6 > FB_MAX_SPEEDS ? FBI_MAX_COORDINATES + 6 : FB_MAX_SPEEDS))

typedef enum fb_port_kind {
  /* at a node; body axes, of exact beams those said. Exact beams have no accelerometer */
  FB_PORT_FORCE = 0,         /* input [N], of an exact beam in port.axes */
  FB_PORT_TORQUE = 1,        /* input [N m] */
  FB_PORT_BASE_VELOCITY = 2, /* input [m/s] of a prescribed base (system: free joint), body axes; node is not used */
  FB_PORT_BASE_RATE = 3,     /* input [rad/s] */
  FB_PORT_DISPLACEMENT = 4,  /* output [m], elastic displacement of a node, body axes; of an exact beam base axes */
  FB_PORT_ROTATION = 5,      /* output [rad], elastic rotation of its section, rotation vector near that of the steady
                                state; attitude is a state, see fb_linear. Of an exact beam section axes in that state */
  FB_PORT_RATE = 6,          /* output [rad/s], a gyro at the node, axes of its section */
  /* output [m/s^2], an accelerometer at the node: acceleration less gravity there. With base motion or a given momentum
     as input the term in the rate of the input is left out (y = C x + D u has no u_dot) */
  FB_PORT_ACCELERATION = 7,
  /* systems; body: the one carried by the joint, axis: of the joint. Exact beams; body: a joint. node is not used */
  FB_PORT_DRIVE = 8,      /* input [N m], [N], motor of a free axis; of a joint of an exact beam that is not driven */
  FB_PORT_COORDINATE = 9, /* output [rad], [m], joint coordinate as fb_joint_motion.value */
  FB_PORT_SPEED = 10,     /* output [rad/s], [m/s], its speed */
  /* systems only; body: the number of a spring; node and axis are not used */
  FB_PORT_PULL = 11,   /* input [N], its actuator */
  FB_PORT_LENGTH = 12, /* output [m], distance between its points */
  /* body: of a system, else 0; axis: the number of a rotor of it; node is not used */
  FB_PORT_MOTOR = 13,       /* input [N m], its motor; of a rotor whose momentum is given [N m s], that momentum */
  FB_PORT_ROTOR_SPEED = 14, /* output [rad/s], relative to its node */
  /* exact beams only, section axes; node: a node, then an element */
  FB_PORT_VELOCITY = 15,        /* output [m/s], as fb_exact_node.velocity */
  FB_PORT_INTERNAL_FORCE = 16,  /* output [N], mean over the element */
  FB_PORT_INTERNAL_MOMENT = 17, /* output [N m] */
  FB_PORT_FORCE_STRAIN = 18,    /* output [-], of the section */
  FB_PORT_MOMENT_STRAIN = 19,   /* output [1/m] */
  /* exact beams only; node: one beyond the root that is held along or about the axis. Of velocities, and of internal loads
     of a damped beam, the term in the rate of these inputs is left out */
  FB_PORT_SUPPORT_DISPLACEMENT = 20, /* input [m], place of the support, base axes, as fb_support_place */
  FB_PORT_SUPPORT_ROTATION = 21,     /* input [rad], section axes in the steady state */
  FB_PORT_COUNT
} fb_port_kind;

typedef struct fb_port {
  fb_port_kind kind;
  int body;       /* of a system, a spring, or a joint of an exact beam; else 0 */
  int node, axis; /* axis 0..2, or a rotor */
  fb_axes axes;   /* of a force or torque on an exact beam, as fb_load; inertial axes at the steady state's instant */
} fb_port;

typedef struct fb_linear_desc {
  int n_in, n_out;
  fb_port in[FB_MAX_PORTS], out[FB_MAX_PORTS];
} fb_linear_desc;

/* Linear model d/dt x = A x + B u, y = C x + D u of perturbations about a steady state. Order of x:
     one body   q, pi, momenta of rotors, momenta, pose
     system     free axes of all joints, q of all bodies, both in the order of the bodies; their conjugate momenta in
                the same order; momenta of rotors
   pi            with a prescribed base relative to the ground
   rotors        those whose momentum is not given; of their friction the tangent
   momenta       p = m u and h, body axes; h of a free base about the center of mass
   pose          position and attitude, body axes, relative to a frame that moves on with the steady v, w (in orbit on
                 its circle). Of momenta and pose the free components: 6 of a free base, 3 of a pinned one (angular), 1
                 of a hinged one (about the hinge), none of a prescribed one. Attitude is last: a star tracker is a row
                 of C with a 1 there
   free axes     free and spherical joints: position and attitude in axes of the child, relative to a frame that moves
                 on with the steady speeds; momenta along the same axes, of a free joint relative to fb_link_state.u,
                 which is constant here. The attitude of a free joint is x_3 to x_5 from its first axis on
   loops         the independent coordinates and their conjugate momenta alone; the others depend on them */
typedef struct fb_linear {
  int n, n_in, n_out;
  int n_free;  /* number of pose components, or of free axes: n = 2 (modes + n_free) + n_rotor */
  int n_rotor; /* momenta of rotors among x */
  /* index of x_i, i < (n - n_rotor)/2 (one body: q alone), among all free axes and q; equal to i without loops */
  int coordinate[FB_MAX_LINEAR / 2];
  fb_real A[FB_MAX_LINEAR * FB_MAX_LINEAR]; /* n x n */
  fb_real B[FB_MAX_LINEAR * FB_MAX_PORTS];  /* n x n_in */
  fb_real C[FB_MAX_PORTS * FB_MAX_LINEAR];  /* n_out x n */
  fb_real D[FB_MAX_PORTS * FB_MAX_PORTS];   /* n_out x n_in */
  fb_real rate[FB_MAX_LINEAR];              /* d/dt x of the state itself: zero, to round-off, in a steady one */
  /* estimated finite-difference error of A, relative to its largest element, with every state in units of its step.
     Round-off (a few FB_EPSILON) and the error of the model are not included */
  fb_real error;
} fb_linear;

typedef struct fb_analyse_work fb_analyse_work; /* scratch; large: make it static */

/* Steady state of a body: sets q, with q_dot = 0, and the momenta that belong to it. state gives the attitude and the
   first guess; at most 40 Newton iterations. input is required, here and in the following functions of one body;
   distributed loads are taken as they are at the state and input.t. It need not be stable: beyond a buckling load the
   unbent state is a steady one, too; the spectrum tells.
     Prescribed   the frame moves with v, w of the input. Gravity and loads in inertial axes, which do not rotate with
                  it, are taken in their present direction
     Free         or pinned: spins at |input.w| about the principal axis of the deformed body nearest to input.w, with
                  the center of mass (or the pin) at rest. With turning rotors w and the momentum of the whole are parallel,
                  found from the direction of input.w, not always the nearest such axis; input.w 0: at rest, whatever
                  they do
     Hinged       spins at input.w about the hinge
     Rotors       keep the momenta that they have in state, or input
     In orbit     a free body with central gravity turns once per circular orbit, at the rate |input.w| about the normal
                  that input.w has without its part along the vertical at the attitude of state. Sets attitude, position
                  and velocity, too: the attitude is in balance with the gradient, loads and rotors. The first guess
                  should be within some 30 degrees and a factor of 1.5 of the distance, about (mu/w.w)^(1/3). The
                  balance need not be stable (see the spectrum); angles about which it is in balance anyhow stay. Other
                  bases feel the field where they are
   FB_ERR_UNREST: loads or gravity accelerate a base that is not prescribed; a motor does not balance the friction of
   its rotor, a given momentum has a rate; a turning rotor has an imbalance (here, in linear models and spectra); in
   orbit input.w 0, or a force along the flight. FB_ERR_VALUE: a w that the hinge does not permit, or along the vertical
   in orbit. FB_ERR_RANGE: beyond the deflection
   limit (buckled, or a large load); FB_ERR_SINGULAR: no stiffness in some direction; FB_ERR_CONVERGENCE. */
FB_API fb_status fb_body_trim(const fb_body *body, fb_state *state, fb_analyse_work *work, const fb_input *input);

#if FB_WITH_SYSTEM

typedef struct fb_system_analyse_work fb_system_analyse_work; /* scratch; large: make it static */

/* Relative equilibrium of a system, loops included; input may be NULL. Prescribed axes have the value and rate of the
   input, locked axes stay, free axes and modes are at rest relative to them. Such a state must exist: one rotating
   axis, or a prescribed free joint with constant v, w in body axes. The tree on a free joint that moves freely spins
   about the principal axis nearest to the w in the rate of its drive, as in fb_body_trim; rotors inside bodies as
   there. The equilibrium may be unstable, and is not always the nearest.
     FB_ERR_UNREST        also wheels with momentum normal to that axis, which make it precess, and a prescribed axis
                          whose motion changes the equilibrium (not looked for under gravity, loads and callbacks, which
                          are taken in their present direction)
     FB_ERR_SINGULAR      also an axis without restoring torque: a hinge at standstill, a wheel (lock it)
     FB_ERR_CONVERGENCE   also a first guess too far away, such as a horizontal pendulum
     FB_ERR_CONTRADICTION a loop cannot be closed
     FB_ERR_UNSUPPORTED   the caller's own constraints; a body with central gravity, here and in linear models and
                          spectra of systems (a satellite of a hub and flexible parts is one body, see fb_body_build)
   else as fb_body_trim and fb_system_rates_eval.
   For the posture of an arm lock its joints, trim, apply the torques that hold them (fb_joint_motion.drive) as motor
   torques and free the joints. For wheels prescribe their rates, trim and free them. fb_system_axis_set changes the
   mode of an axis and keeps the momenta; the state is then ready for fb_system_linearize. */
FB_API fb_status fb_system_trim(const fb_system *system, const fb_body *body, fb_system_state *state,
                                fb_system_analyse_work *work, const fb_system_input *input);
#endif

#if FB_WITH_EXACT
/* ---- geometrically exact beam: arc-length continuation */

typedef struct fb_exact_path {           /* position on a path of steady states; all zero: its start */
  fb_real factor;                        /* load factor of the varied loads */
  fb_real rise;                          /* d factor/d arc, -1..1; its sign changes at a limit point */
  fb_real arc;                           /* length of the last step */
  int unstable;                          /* as in fb_exact_work */
  int iterations;                        /* of the last step, over all trials */
  fb_real ahead[6 * (FB_MAX_EXACT + 1)]; /* internal: tangent of the path */
} fb_exact_path;

typedef struct fb_exact_path_work fb_exact_path_work; /* scratch; large: make it static */

/* One step of arc-length continuation along the path of steady states under `constant` (NULL: gravity alone) and
   path->factor times the loads and the ways of supports of `varied`. The path passes limit points, where a load that
   only grows would jump (snap-through, snap-back), and buckling loads, where a small constant imperfection load selects
   the branch.
   state: in and out; at first that of fb_exact_trim under `constant`, with a path all zero. The motion v, w of the base
   is that of `constant`.
   arc: length of the step, shortened where the path is strongly curved. arc^2 is the mean over the nodes of
   displacement^2/length^2 + rotation^2, plus the square of the change of factor: scale `varied` to about the loads of
   interest, and take arc 0.02 to 0.1. At the start the factor increases, with arc < 0 it decreases; later the path
   keeps its direction, and arc < 0 goes back. An imperfection too small for the arc is stepped over, along the branch
   that is unstable there, as path->unstable shows. To find the state at a given factor, call fb_exact_trim from a state
   near it.
   At most 11 trials, each half as long as the one before, of 12 iterations (one factorization each).
   FB_ERR_CONVERGENCE; FB_ERR_VALUE: arc zero, or not finite; else as fb_exact_trim. On failure path and state are
   unchanged. */
FB_API fb_status fb_exact_path_step(const fb_exact *exact, fb_exact_path *path, fb_exact_state *state,
                                    fb_exact_path_work *work, const fb_exact_input *constant,
                                    const fb_exact_input *varied, fb_real arc);
#endif

/* ---------------------------------------------------------------------------------------------------------------
   ANALYSE >>linear: linear models, complex modes, step advice */

/* Linearizes the motion of a body about a steady state (of fb_body_trim or otherwise), with the inputs and outputs of
   desc (NULL: none). Each element is the best of finite differences of several widths; linear->error, their error
   without round-off, is below 1e-10 (single precision: 1e-3) but near the limit of a body's range. The steps of the
   inputs are scaled by the forces that act already: the unit of force has no influence.
   FB_ERR_CONVERGENCE: an error above 0.01; FB_ERR_CAPACITY: a port of a node or body that does not exist, no room in
   input for one more load; FB_ERR_VALUE: an axis, an input kind among the outputs or the reverse, motion of a base that
   is not prescribed, a port of systems. */
FB_API fb_status fb_body_linearize(const fb_body *body, fb_analyse_work *work, fb_linear *linear, const fb_state *state,
                                   const fb_input *input, const fb_linear_desc *desc);

/* Complex eigensolution, ascending by |re + i im|; of a conjugate pair the one with im > 0 */
typedef struct fb_spectrum {
  int n;
  fb_real re[FB_MAX_LINEAR], im[FB_MAX_LINEAR]; /* [1/s], [rad/s]; unstable where re > 0 */
  /* [1/s] estimated error of re + i im by the finite differences of A: unstable where re > error. The eigensolver adds
     round-off of some FB_EPSILON of the fastest mode: in single precision the slow modes of light, stiff bodies that
     carry heavy ones are lost first. Smaller eigenvalues cannot be distinguished from zero */
  fb_real error[FB_MAX_LINEAR];
  /* mode shapes: elastic coordinates, n x body.n; of a system all free axes, then all elastic coordinates */
  fb_real shape_re[FB_MAX_LINEAR * FB_MAX_LINEAR / 2];
  fb_real shape_im[FB_MAX_LINEAR * FB_MAX_LINEAR / 2];
} fb_spectrum;
/* Complex modes about a steady state (of fb_body_trim), with spin, gyroscopic terms, preload and damping ([H] A.15).
   The states include the momenta of a base that is not prescribed (nutation), and its pose only if the motion depends
   on it (gravity, loads in inertial axes). In orbit the spectrum contains that of the orbit: 0 twice, +-i w twice.
   FB_ERR_CONVERGENCE: as fb_body_linearize, or the error of a mode is above 0.01 of the fastest. */
FB_API fb_status fb_body_spectrum_solve(const fb_body *body, fb_analyse_work *work, fb_spectrum *spectrum,
                                        const fb_state *state, const fb_input *input);
#if FB_WITH_SYSTEM
/* As fb_body_linearize, of a system. Prescribed and locked axes are not states; an axis that moves at a constant rate
   is taken at its present position (with gravity normal to it A would not be constant). FB_ERR_CAPACITY: also an axis
   that the joint does not have, more than FB_MAX_LINEAR states; FB_ERR_VALUE: also FB_PORT_DRIVE of an axis that is not
   free. */
FB_API fb_status fb_system_linearize(const fb_system *system, const fb_body *body, fb_system_analyse_work *work,
                                     fb_linear *linear, const fb_system_state *state, const fb_system_input *input,
                                     const fb_linear_desc *desc);
/* Complex modes of a system, as fb_body_spectrum_solve. Position and attitude of free joints are left out (zero in the
   shapes) if the motion does not depend on them. */
FB_API fb_status fb_system_spectrum_solve(const fb_system *system, const fb_body *body, fb_system_analyse_work *work,
                                          fb_spectrum *spectrum, const fb_system_state *state,
                                          const fb_system_input *input);
#endif

/* Damping ratio -re/|re + i im| of mode k: 1 aperiodic, 0 undamped (or no such mode), negative unstable. */
FB_API fb_real fb_spectrum_damping(const fb_spectrum *spectrum, int k);
/* Stability margin [1/s] of n modes by their re (of fb_spectrum, fb_exact_spectrum, fb_exact_linear): the smallest -re,
   negative if a mode grows. *mode: the mode that has it (NULL: not requested), or the first whose re is not finite.
   n = 0: FB_HUGE, mode -1. Without damping it is round-off, of double eigenvalues (rigid-body motion) the root of it. */
FB_API fb_real fb_spectrum_margin(int *mode, const fb_real *re, int n);

/* Largest step [s] at which the integrator is stable for every mode; one that grows by itself counts as an undamped one
   of its frequency. FB_HUGE of implicit integrators; 0: an invalid integrator or spectrum. For a base that spins freely
   some 3 % too long at |w| dt = 0.3, up to 25 % at 0.7. Steps refuse what is beyond their own, quicker bounds, most of
   which are shorter (fb_rk4_limit, fb_implicit_limit, fb_system_rk4_limit): take the smaller one, or set
   allow_long_step. */
FB_API fb_real fb_spectrum_limit(const fb_spectrum *spectrum, fb_integrator integrator);
/* Step [s] at which the largest errors of the modes within `duration` [s] add up to `tolerance`, at most the duration
   and 0.9 of the stability limit. amplitude: of each mode, in the unit of the tolerance (NULL: 1 each, the fastest mode
   decides). 0: an invalid integrator, duration, tolerance or amplitude, or no step is short enough (a mode grows too
   far). Linear about a state, so less accurate with larger motion; without the error of the steady motion itself, such
   as the attitude of a base that spins freely. */
FB_API fb_real fb_spectrum_dt(const fb_spectrum *spectrum, fb_integrator integrator, const fb_real *amplitude,
                              fb_real duration, fb_real tolerance);
/* The errors of fb_spectrum_dt at a step of dt [s]: their sum, in the unit of the amplitudes (NULL: 1 each). 0 for an
   invalid integrator, dt, duration or amplitude. */
FB_API fb_real fb_spectrum_error(const fb_spectrum *spectrum, fb_integrator integrator, const fb_real *amplitude,
                                 fb_real dt, fb_real duration);

#if FB_WITH_EXACT
/* ---- geometrically exact beam */

#define FB_EXACT_MODES 24 /* maximum number of modes of a call */
#define FBI_EXACT_BASIS 120
#define FBI_EXACT_DIM (18 * FB_MAX_EXACT + 12)

typedef struct fb_exact_spectrum { /* ascending by |re + i im|; of a conjugate pair the one with im > 0 */
  int n;
  /* [1/s], [rad/s]. Elements keep d'Alembert's principle: without follower loads and damping, re of a beam that is stable
     is rounding, some 1e-14 of the modulus whatever the mesh is (1e-6 in single precision) */
  fb_real re[FB_EXACT_MODES], im[FB_EXACT_MODES];
  fb_real error[FB_EXACT_MODES]; /* estimated relative error of iteration and rounding (not of the mesh) */
  /* Motion of the nodes relative to the steady state, section axes, per mode 6 (n_element + 1): displacement [m] and
     rotation [rad], scaled so that the largest displacement, or rotation times length, is 1 m. */
  fb_real shape_re[FB_EXACT_MODES * 6 * (FB_MAX_EXACT + 1)], shape_im[FB_EXACT_MODES * 6 * (FB_MAX_EXACT + 1)];
} fb_exact_spectrum;

typedef struct fb_exact_spectrum_work fb_exact_spectrum_work; /* scratch; large: make it static */

/* The `count` (1..FB_EXACT_MODES) complex modes with the smallest |lambda| about a steady state of fb_exact_trim with
   the same input, in the frame of the base: vibration, whirl, flutter, buckling (lambda = 0). The rigid-body modes of
   an unsupported beam are included; their eigenvalues are zero within the square root of round-off.
   FB_ERR_CONVERGENCE: fewer than requested have converged; with desc.damping also one at 1/damping or faster:
   eigenvalues of overdamped modes gather there, so that some would be left out. FB_ERR_MODES: the beam has fewer,
   without inertia those of dampers alone. */
FB_API fb_status fb_exact_spectrum_solve(const fb_exact *exact, fb_exact_spectrum_work *work,
                                         fb_exact_spectrum *spectrum, const fb_exact_state *state,
                                         const fb_exact_input *input, int count);

#define FB_EXACT_STATES (2 * FB_EXACT_MODES)

/* Modal model d/dt x = A x + B u, y = C x + D u of perturbations about the steady state. An aperiodic mode has one
   state; the others have two, a and b, with the block [re -im; im re] in A and the motion Re(shape (a + i b)), shape as
   in fb_exact_spectrum. D contains the static response of the modes left out: the static gain D - C A^-1 B is that of
   the whole beam. */
typedef struct fb_exact_linear {
  int n, n_in, n_out, n_mode;
  fb_real re[FB_EXACT_MODES], im[FB_EXACT_MODES]; /* as fb_exact_spectrum */
  fb_real A[FB_EXACT_STATES * FB_EXACT_STATES];   /* n x n */
  fb_real B[FB_EXACT_STATES * FB_MAX_PORTS];      /* n x n_in */
  fb_real C[FB_MAX_PORTS * FB_EXACT_STATES];      /* n_out x n */
  fb_real D[FB_MAX_PORTS * FB_MAX_PORTS];         /* n_out x n_in */
} fb_exact_linear;

typedef struct fb_exact_linear_work fb_exact_linear_work; /* scratch; large: make it static */

/* Modal model with the `count` slowest modes (modes with equal eigenvalues stay together: one or two more) about a
   steady state of fb_exact_trim with the same input, for the inputs and outputs of desc (NULL: none). Its eigenvalues
   are those of fb_exact_spectrum_solve, and its static response is exact. Base velocity and rate move the frame in
   which the beam is described; gravity and dead loads, which do not rotate with it, keep their present direction.
   Supports stay where they are in that frame, but for inputs that move them.
   FB_ERR_SINGULAR: no static response (an unsupported beam, a limit point), or two parallel modes (onset of flutter);
   FB_ERR_VALUE, FB_ERR_CAPACITY: count, or a port that does not exist; else as fb_exact_spectrum_solve. On failure
   linear is unchanged. */
FB_API fb_status fb_exact_linearize(const fb_exact *exact, fb_exact_linear_work *work, fb_exact_linear *linear,
                                    const fb_exact_state *state, const fb_exact_input *input,
                                    const fb_linear_desc *desc, int count);
#endif

/* ---------------------------------------------------------------------------------------------------------------
   ANALYSE >>advise: which effects, modes, integrator and step a scene calls for; offline. For bodies in the momentum
   form with every effect compiled in. For a system ask about each body, with the motion of its root as that of a
   prescribed base. */

typedef struct fb_envelope {     /* the extremes of a scene; signs as they occur together */
  fb_real velocity[3];           /* [m/s] of O of a prescribed base, body axes */
  fb_real spin[3], spin_rate[3]; /* [rad/s], [rad/s^2] of the body frame, its axes; the rate: prescribed bases only */
  fb_real acceleration[3];       /* [m/s^2] of O less gravity, body axes, as an accelerometer at O reads it; without a
                                     prescribed base minus gravity; the extreme of each axis */
  int n_load;                    /* extreme loads; in axes of the body or of the node */
  fb_load load[FB_MAX_LOADS];
  fb_real frequency; /* [rad/s] of the excitation: 0 steady, FB_HUGE a step load, else the highest that matters */
  int smooth;        /* 1: it begins and ends as 1 - cos, which leaves less vibration of faster modes; 0: as a sine */
  fb_real duration;  /* [s] of the simulation */
  fb_real lasts;     /* [s] from the start after which nothing acts: no loads, no spin, a base at rest; at least the
                         duration: all of that has no end; 0: not known, or some of it stays */
  fb_real frame;     /* [s] divided by whole steps (or steps below a millionth of it): a control period; 0: any step */
  int node;          /* the output is the elastic displacement of this node */
#if FB_WITH_ROTORS
  /* extremes of the rotors of the desc: torque of the motor beside what balances friction; momentum, given or not.
     frequency need not have the nutation that they cause */
  fb_rotor_input rotor[FB_MAX_ROTORS];
#endif
} fb_envelope;

#define FB_ADVICE_EFFECTS 5 /* inertial effects: bits 0..4 of fb_effect */

typedef struct fb_advice {
  unsigned effects;             /* for fb_body_desc; with damping and gravity if the desc has them */
  int n;                        /* number of modes */
  int coordinate[FB_MAX_MODES]; /* the modes, ascending: for fb_shape_select */
  fb_integrator integrator;
  int long_step;   /* 1: dt exceeds the integrator's limit (found by simulation): set fb_body_desc.allow_long_step */
  int line_points; /* for fb_modes_desc with large deflection: as many as these modes want, of which cost is; 0: without
                         it. The shape need not be made again: more points take more time, no more error */
  int n_trial;     /* number of simulations */
  fb_real dt;      /* [s] */
  fb_real cost;    /* approximate number of instructions of a 64-bit processor per simulated second */
  fb_real deflection; /* [m] estimated maximum of the output, at most half the size of the body: beyond it a lower
                         bound */
  /* estimated errors of the output relative to deflection: by missing effects, by missing modes, by the step (an upper
     bound; not from fb_advice_search), and by terms that the model lacks: those of its displacement field, error_field,
     unless effects have FB_EFFECT_LARGE_DEFLECTION */
  fb_real error_effects, error_modes, error_step, error_model, error_field;
  fb_real without[FB_ADVICE_EFFECTS]; /* the same without effect 1 << i, for the best set without it */
  fb_real error;                      /* by simulation (fb_advice_search), else the sum of the four */
} fb_advice;

#define FBI_ADVICE_SETS 11
#define FBI_ADVICE_INSTANTS 5
#define FBI_ADVICE_PHASES 3
#define FBI_ADVICE_TIMES 129 /* a quasi-static one, then those of two drives */
#define FBI_ADVICE_PARTS 16  /* trial steps per integrator */

typedef struct fb_advice_work fb_advice_work; /* scratch; large: make it static */

/* Finds the cheapest set of effects, modes, integrator and step whose estimated errors add up to at most four fifths of
   the tolerance (relative to the largest output). error_model uses at most 0.7 of the tolerance; if it is larger, error
   exceeds the tolerance, and large deflection is advised (FB_EFFECTS_LARGE), if the shape has lines (lines_status FB_OK)
   and no load case buckles it or bends it by more than five lengths. A step of fb_exponential_step with it is one that
   the deflections of the load cases allow; a run that bends much farther is refused (FB_ERR_STEP).
   The estimates compare the accelerations of each set at the extremes of the envelope, and the motion of the body with
   and without some modes, linear, while its base recoils: bounded work, no simulation. They are often wrong by a factor
   of three. shape: natural modes of each appendage, more than will be needed; modes are taken in the order of what they
   matter to the output, also those of other appendages by the recoil.
   FB_ERR_EFFECTS: an effect was removed at compile time; FB_ERR_VALUE: negative frequency, frame or lasts, duration or
   tolerance not positive, no modes, no output; FB_ERR_CAPACITY: a node; FB_ERR_UNSUPPORTED: the coordinates are not
   natural modes, a rotor has an imbalance, or rotors couple the modes too much for an estimate; FB_ERR_STEP: no
   integrator meets the tolerance; else as fb_body_init and fb_body_motion_eval. */
FB_API fb_status fb_advice_solve(fb_advice *advice, fb_advice_work *work, const fb_shape *shape,
                                 const fb_body_desc *desc, const fb_envelope *envelope, fb_real tolerance);

typedef struct fb_trial { /* simulation of a scene, by the caller */
  /* simulates the scene with the effects, modes (fb_shape_select), integrator and step of the candidate and writes
     output[0..n-1]; a status other than FB_OK rejects the candidate */
  fb_status (*run)(void *user, fb_real *output, const fb_advice *candidate);
  void *user;
  int n;                       /* length of an output, in samples of */
  int width;                   /* this many numbers each: an error is the norm of the difference of two samples */
  fb_real *output, *reference; /* n each */
  int has_reference; /* 0: the reference is simulated first, with all modes and effects and a short step; 1: it is given
                        (by the geometrically exact beam, or measured) */
} fb_trial;

/* Finds the cheapest set by simulation: candidates are simulated in the order of their estimated cost, up to that of
   the reference, until one meets the tolerance. Every cheaper candidate was simulated and rejected, or the error of its
   effects and modes no longer depended on the step.
   The reference has large deflection if the shape has lines; where run returns FB_ERR_UNSUPPORTED for it all effects
   but that, and for a candidate no step of its integrator with its effects is tried again.
   error: largest distance from the reference, relative to its largest sample. For desktop use: tens to thousands of
   simulations, with n modes at most 2 + 176 n FB_INTEGRATOR_COUNT.
   FB_ERR_CONVERGENCE: no candidate meets the tolerance, or all modes and effects with a short step exceed twice the
   tolerance; FB_ERR_VALUE, FB_ERR_NOT_FINITE: also a reference of zeros or that is not finite; a status of run for all
   modes and effects; else as fb_advice_solve. */
FB_API fb_status fb_advice_search(fb_advice *advice, fb_advice_work *work, const fb_shape *shape,
                                  const fb_body_desc *desc, const fb_envelope *envelope, fb_real tolerance,
                                  const fb_trial *trial);

#endif /* FB_WITH_ANALYSE */

/* ---------------------------------------------------------------------------------------------------------------
   >>scratch: what the functions above work in. What is in it means nothing between calls, but for the few members that
   are named where the struct is declared */

#if FB_WITH_LARGE_DEFLECTION
typedef struct fbi_line_work { /* what an evaluation knows about the lines, line axes, by coordinate axis and point */
  fb_real turn[3][FB_MAX_POINTS], bow[3][FB_MAX_POINTS]; /* A q, B q of the interval before a point */
  fb_real stretch[3][FB_MAX_POINTS];                     /* sum Gamma_a q_a */
  fb_real phi[3][FB_MAX_POINTS];                         /* rotation vector of the interval */
  fb_real x[FB_MAX_POINTS];                              /* |phi|^2 */
  fb_real a[FB_MAX_POINTS], b[FB_MAX_POINTS];            /* (1 - cos)/|phi|^2, (|phi| - sin)/|phi|^3 */
  fb_real a_dot[FB_MAX_POINTS], b_dot[FB_MAX_POINTS];    /* their rates */
  fb_real quat[4][FB_MAX_POINTS];                        /* rotation as a quaternion */
  fb_real H[9][FB_MAX_POINTS], N[9][FB_MAX_POINTS];      /* rotation; rate of it per rate of phi */
  fb_real t[3][FB_MAX_POINTS], r[3][FB_MAX_POINTS];      /* tangent, position from O */
  fb_real turn_dot[3][FB_MAX_POINTS], bow_dot[3][FB_MAX_POINTS], phi_dot[3][FB_MAX_POINTS]; /* rates */
  fb_real glide[3][FB_MAX_POINTS], t_dot[3][FB_MAX_POINTS]; /* H Gamma q_dot, rate of the tangent */
  fb_real w[3][FB_MAX_POINTS], v[3][FB_MAX_POINTS];         /* velocities relative to the frame */
  fb_real w_dot[3][FB_MAX_POINTS], v_dot[3][FB_MAX_POINTS]; /* accelerations by velocities, E14.9 */
  fb_real hung[9][FB_MAX_POINTS]; /* what lines that hang on a point add to its force and moments */
  fb_real root[FB_MAX_LINES][3], root_dot[FB_MAX_LINES][3]; /* displacement of a line's root by the modes; its rate */
  fb_real Jw[FB_MAX_MODES][3][FB_MAX_POINTS], Jr[FB_MAX_LINES][FB_MAX_MODES][3]; /* per rate of a line's coordinate:
                                                            of the points, velocity of the root */
  fb_real Y[FB_MAX_MODES][3 * FB_MAX_POINTS]; /* velocities of a line's points, weighed (E14.17) */
  fb_real place[3 * FB_MAX_POINTS];       /* likewise positions of the mass centers, line by line, 3 x stride each */
  fb_real gradient[FB_MAX_MODES];         /* dT/dq */
  fb_real push[3];                        /* [N] E14.15 */
  fb_real L[FB_MAX_MODES * FB_MAX_MODES]; /* Cholesky factor of M(q) */
  fb_real X[6 * FB_MAX_MODES];            /* Lambda(q), 6 x n, body axes */
  fb_real column[FB_MAX_MODES][8];        /* columns of Lambda L^-T, element of L^-1 pi, a spare one */
  fb_real M_rr[21];                       /* M_rr(q) */
  fb_real center[3]; /* [m] R c(q)/m of a free body where its step began, inertial axes: O from the mass center */
  fb_line_point point[FB_MAX_LINE_POINTS]; /* with distributed loads */
} fbi_line_work;
#endif

typedef struct fbi_sym6_factors { /* of a 6x6, E3.1 */
  fb_real L[6], G[6], Z[9], W[9];
} fbi_sym6_factors;

typedef struct fbi_kinetics {   /* what an evaluation knows about a state */
  fb_real R[9];                 /* body to inertial axes */
  fb_real qx[FB_MAX_MODES + 1]; /* (1, q) */
  fb_real D[6 * FB_MAX_MODES];  /* rows of -Lambda(q) that depend on q, without constants; not of a body with lines */
  fb_real Minv_pi[FB_MAX_MODES];
  const fb_real *pb; /* M^-1 pi: the above, or pi itself where M = 1 */
  fb_real V[6];      /* (v, w), body axes; of single bodies v relative to state.u */
#if FB_WITH_ROTORS
  fb_real rotor_axis[FB_MAX_ROTORS][3]; /* body axes */
  fb_real rotor_momentum[FB_MAX_ROTORS], rotor_speed[FB_MAX_ROTORS];
#endif
  fb_real ph[6];         /* (p, h), body axes */
  fb_real S[21], dS[21]; /* S(q) and its rate, when they were needed */
  int loaded;            /* loads or gravity act: fg is not zero */
  fb_real fg[6];         /* resultant force and torque about O of loads and gravity, body axes; free bodies: 0 and
                                  the torque about the mass center, E8.33 */
  fb_real a[3];          /* [m/s^2] acceleration of a free body's mass center by the loads, body axes */
#if FB_WITH_GRAVITY
  fb_real fall[3], fall_rate; /* [m/s^2], [rad/s] by central gravity: of the mass center, inertial axes; E8.37 */
#endif
  fb_real x[FB_MAX_MODES + 1]; /* elastic forces by (1, q): loads and gravity, then inertia; x[0] is not used */
  fb_real e[FB_MAX_MODES];     /* scratch */
#if FB_WITH_NONLINEAR_STRAIN
  fb_real slope[3][FBI_MAX_STRAINS]; /* u_x', u_y', u_z' at the strain stations */
#endif
#if FB_WITH_LARGE_DEFLECTION
  fbi_line_work *line;
#endif
} fbi_kinetics;

typedef struct fbi_node_field {   /* a node on the deformed body, body axes */
  fb_real u[3], phi[3];           /* displacement, rotation parameters */
  fb_real Ju[3 * FB_MAX_MODES];   /* n x 3: velocity per q_dot */
  fb_real Jphi[3 * FB_MAX_MODES]; /* n x 3: angular rate per q_dot */
  fb_real turn[3 * FB_MAX_MODES]; /* n x 3: rate of phi per q_dot */
#if FB_WITH_LARGE_DEFLECTION
  fb_real quat[4]; /* of a node on a line, in place of phi and its rates */
#endif
} fbi_node_field;

#if FB_WITH_SYSTEM
typedef struct fbi_link_work {
  fbi_kinetics k;
  const fb_joint *joint; /* where it is placed: by which it hangs, what it is, on what */
  const fb_body *model;
  struct fbi_link_work *parent;
  int about;      /* 1..3: C is a rotation about that axis; 0: it is not */
  int axis[3];    /* so: that axis and the two across it */
  int hinge;      /* 3..5: a free axis of this one component of A, through O; 0: it is not */
  int has_speeds; /* q_dot is known */
  int had_speeds;
  int coupled, open; /* its modes carry something; they are in E, X, Z below */
  int settled;       /* S, U and D are the same at every state; 2: known */
  int passed;        /* the last row whose impulse passed it; or none, FBI_ENDS; nor will one, FBI_ALL_LINKS */
  int root;          /* the body by which its tree hangs; of free trees that are tied: the first of them */
  fb_axis_mode mode[3];
  fb_real rho[3], C[9], s[3], arm[3]; /* O; axes to the parent's; O from the parent's O; O from the node it hangs on */
  fb_real origin[3], frame[3];        /* of roots: what rho of the tree is from; its velocity, that of the momenta */
  fb_real change[3], glide[3], center[3];   /* of roots: that of frame, integral of P, m times the mass center before */
  fb_real total, impulse[3];                /* of roots: mass and momentum of the tree */
  fb_real turn[3];                          /* w at the start of the step */
  fb_real own[3], own_start[3], own_sum[3]; /* of roots: L in body axes at a stage, at the start, its increment */
  int held;                                 /* of roots: constraints push it from outside, 2: from the ground */
  fb_real bulk, first[3];                   /* mass of all that hangs here and its first moment about O, body axes */
  fb_real n[3];                             /* that node, parent's axes */
  fbi_node_field node;
  const fb_real *A;             /* twists of the axes: the joint's own, or where the first one turns.. */
  fb_real turned[12], A_dot[6]; /* ..these; rate of the first one */
  fb_real S[21];                /* articulated inertia */
  fb_real mass, moment; /* [kg, kg m^2] the most that one axis has taken out of S, about O: S has its rounding */
  fb_real U[18], D[3];  /* S A, 1/(A S A) */
  int factored;         /* of a free joint: the factors of S are known */
  fbi_sym6_factors factors;
  /* In an implicit step: of the axes of a joint with friction or stops; of a free joint on springs the stiffness of its
     rotation, 3x3 */
  fb_real stiffness[9], damping[3];
  fb_real mooring[6]; /* of a free joint on springs: their force and moment about O, body axes */
  fb_real E[FB_MAX_MODES * FB_MAX_MODES], X[6 * FB_MAX_MODES];
  fb_real y[6], p[6], pi[FB_MAX_MODES];                                  /* right-hand side */
  fb_real b[6], r[3], e[FB_MAX_MODES];                                   /* eliminated */
  fb_real V[6], u[6], q_dot[FB_MAX_MODES];                               /* solution */
  fb_real rate[6];                                                       /* V of a free root by what was eliminated */
  fb_real V_dot[6], twist[6], speed[6], given[6], q_speed[FB_MAX_MODES]; /* of accelerations */
  fb_real G[6], F[6];                                                    /* momentum and load of all that hangs here */
  fb_real spin, acceleration;
#if FB_WITH_LARGE_DEFLECTION
  fb_status lines_status; /* of its lines at q: FB_OK, or an interval turns too far */
#endif
} fbi_link_work;

typedef struct fbi_end { /* one side of a constraint */
  int link, node, moves;
  fb_real n[3], N[9];             /* the node, its section axes: body axes */
  fb_real x[3], R[9], v[3], w[3]; /* node, section axes, motion: inertial axes; of springs, of what forces look at */
  fb_real move[6], a[6];          /* v, w of a solution; accelerations: body axes */
  fb_real impulse[6], push[6];    /* sums of mu times the wrenches of the rows, times their rates: body axes */
  fbi_node_field f;               /* of bodies with modes */
} fbi_end;

typedef struct fbi_frames { /* joint frames, axes P of the joint on its parent: sketch at fbi_frames_eval */
  fbi_end *end[2];
  int at[2];                               /* indices of the ends */
  int on;                                  /* the last body that carries both ends, FB_GROUND: none */
  fb_real D[2][9];                         /* P to the axes of the body of each end, of the ground inertial ones */
  fb_real b[3][3];                         /* axes x, y, z on the child */
  fb_real arm[2][3], own_arm[2][3];        /* from each end to the joint's origin on the child; in its body's axes */
  fb_real step[3];                         /* to there from the origin on the parent */
  fb_real lever[FB_MAX_BODIES];            /* distances to there from the joints that lead to the ends */
  fb_real u[2][3];                         /* velocities of the frames of the trees, if not of one body */
  fb_real v[2][3], w[2][3], arm_dot[2][3]; /* of the ends by a solution */
} fbi_frames;

typedef struct fbi_span { /* of a spring, between its points; inertial axes */
  fbi_end end[2];
  fb_real arm[2][3];         /* of the points from the nodes */
  fb_real step[3], along[3]; /* from the first to the second; unit vector */
  fb_spring_motion at;
} fbi_span;

typedef struct fbi_row {
  fb_row r;            /* of a joint in its axes P */
  const fbi_frames *f; /* of a joint; NULL: a row of the caller's */
  int end[2], joint, axis;
  fb_real wrench[2][6]; /* force, torque at each end, axes of its body */
  fb_real size[2][2];   /* of a force and a torque at one point at each end, of a joint x[1], else the node */
  fb_real force_dot[2][3], torque_dot[2][3], b_dot; /* the first two of the caller's */
  fb_real most;                                     /* upper bound of its value without impulses */
} fbi_row;

typedef struct fbi_way { /* a row on the axes and modes of the bodies that lead to its ends, eliminated (E9.9) */
  int n, link[FB_MAX_BODIES];
  fb_real axis[FB_MAX_BODIES][6], mode[FB_MAX_BODIES][FB_MAX_MODES];
  fb_real turns[FB_MAX_BODIES], slides[FB_MAX_BODIES]; /* at most, before it is eliminated, of axes that do so */
} fbi_way;

struct fb_system_work {
  int joint; /* after a failure: the joint at fault (loops after the bodies), -1: none, -2 - k: row k of the caller's */
  int closed;    /* there are loops */
  int special;   /* so, or rotors inside bodies */
  int floating;  /* of a step: a tree's frame may move */
  int repeats;   /* within a step: what belongs to the links is known */
  int driven;    /* an axis is prescribed */
  fb_real heavy; /* modal mass is scaled by 1 + heavy while loops are closed, so that joints move, modes do not */
  fb_real clock; /* [s] since the frames were at their origins */
  int owns;      /* roots that are free take L in body axes from link.own */
  int n_row, n_joint_row, n_end;
  fbi_link_work link[FB_MAX_BODIES];
  fbi_end end[FBI_MAX_ENDS];
  fbi_row row[FB_MAX_ROWS];
  fbi_way way[FB_MAX_ROWS];
  fbi_frames frames[FB_MAX_LOOPS]; /* of the joints of loops, as the rows were filled */
  fb_row ahead[FB_MAX_ROWS], behind[FB_MAX_ROWS];
  fb_pose pose[FB_MAX_BODIES];
  fb_real Q[FB_MAX_ROWS * FB_MAX_ROWS], L[FB_MAX_ROWS * FB_MAX_ROWS];
  fb_real mu[FB_MAX_ROWS], c[FB_MAX_ROWS], column[FB_MAX_ROWS], diagonal[FB_MAX_ROWS], angle[FB_MAX_ROWS];
  int kind[FB_MAX_ROWS], order[FB_MAX_ROWS], rank;
  fb_real M[FB_MAX_SPEEDS * FB_MAX_SPEEDS], T[6 * FB_MAX_BODIES * FB_MAX_SPEEDS];
  fb_real z[FB_MAX_SPEEDS], speed[FB_MAX_SPEEDS];
  int perm[FB_MAX_SPEEDS];
  fb_system system;
  fb_system_input between;
  fb_system_forces forces;
  int has_forces; /* they are those of a callback */
  fbi_span span;
  fb_real spring_elastic[FB_MAX_SPRINGS], spring_damping[FB_MAX_SPRINGS]; /* [1/s^2], [1/s] in the step limit.. */
  fb_real elastic, damping;                                               /* ..and their sums */
  fb_real impact[2]; /* of stops: bound of a joint of the tree, greatest stop_loss times speed of one of a loop */
  fb_system_state stage, rate, sum, first, base;
#if FB_WITH_LARGE_DEFLECTION
  fbi_line_work line[FB_MAX_BODIES];
#endif
};
#endif

#if FB_WITH_EXACT
typedef struct fbi_exact_motion { /* how pose, velocity and momentum hang on the unknowns d of the nodes */
  int march;                      /* d is the velocity; else a change of pose */
  int inertia, gravity, dead;     /* velocities, gravity, dead loads (1: on elements, 2: on nodes) are there */
  fb_real pose;                   /* change of pose by d */
  fb_real shift;                  /* rate of a strain, momentum or pose by itself */
  int damped;                     /* structural damping counts */
  int potential;                  /* gravity and dead forces have one (E11.56) */
} fbi_exact_motion;

/* Functions of the twist of an element (E10.28). */
typedef struct fbi_exact_twist {
  fb_real f[6], even, screw, beta[6];
} fbi_exact_twist;

/* What an element knows about itself, and the derivatives of it. */
typedef struct fbi_exact_cell {
  fb_real h;
  fb_real strain[6], theta[6]; /* strain, twist from end to end */
  fbi_exact_twist twist;
  fb_real V[6], P[6];          /* of the middle: velocity, momentum per length */
  fb_real f[6], dead[6], G[3]; /* load per length there, dead line loads, gravity */
  fb_real p[6], F1[6], F2[6];  /* ad(theta)^T s; loads on the nodes */
} fbi_exact_cell;

typedef struct fbi_exact_jacobian {
  fb_real D1[36], D2[36], E[36]; /* of the compatibility by the nodes, by the stress */
  fb_real F1d1[36], F1d2[36], F1s[36], F2d1[36], F2d2[36], F2s[36];
} fbi_exact_jacobian;

struct fb_exact_work {
  int iterations, increments; /* of fb_exact_trim: Newton iterations, load increments tried */
  int unstable;               /* number of unstable directions of the steady state; 0: stable */
  fbi_exact_motion motion;
  fb_real gravity[3], twist[6], half[9]; /* in base axes; motion of the base, its turn in half a step */
  fb_real before[4];                     /* inverse of that turn, a quaternion */
  fb_real drift[3];                      /* velocity u there, in base axes of the middle */
  fb_real line[6 * FB_MAX_EXACT], line_dead[6 * FB_MAX_EXACT], offset[6 * FB_MAX_EXACT];
  fb_real follower[6 * (FB_MAX_EXACT + 1)], dead[6 * (FB_MAX_EXACT + 1)];
  fb_real r[3 * (FB_MAX_EXACT + 1)], quat[4 * (FB_MAX_EXACT + 1)], R[9 * (FB_MAX_EXACT + 1)];
  fb_real V[6 * (FB_MAX_EXACT + 1)], G[6 * (FB_MAX_EXACT + 1)], s[6 * FB_MAX_EXACT];
  fb_real
      middle[9 * FB_MAX_EXACT]; /* dead loads, gravity in axes of the middles of elements at the start of the step */
  fb_real strain[6 * FB_MAX_EXACT], momentum[6 * FB_MAX_EXACT], velocity[6 * (FB_MAX_EXACT + 1)],
      node_momentum[6 * (FB_MAX_EXACT + 1)];                                            /* where rates start */
  fb_real B[6 * (FB_MAX_EXACT + 1)], c[6 * FB_MAX_EXACT], want[6 * (FB_MAX_EXACT + 1)]; /* residuals */
  fb_real power;                                                   /* of gravity and dead forces at mid-step */
  fb_real way[2][6 * (FB_MAX_EXACT + 1)], away, along[2], pull[3]; /* of held nodes back to their place (E10.16) */
  int moved; /* supports are not where they are built: their places at the start of the step, their twists, base axes */
  fb_real place_r[3 * (FB_MAX_EXACT + 1)], place_quat[4 * (FB_MAX_EXACT + 1)], place_V[6 * (FB_MAX_EXACT + 1)];
  /* Joints: angle at the start of the step, or near that of the steady state; where its rate starts from; driven ones:
     angle to hold in a steady state; motors */
  fb_real angle[FB_MAX_LUMPS], angle_base[FB_MAX_LUMPS], hold[FB_MAX_LUMPS], motor[FB_MAX_LUMPS];
  fb_real F[6 * (FB_MAX_EXACT + 1)], P[6 * FB_MAX_EXACT];
  fb_real dd[6 * (FB_MAX_EXACT + 1)], ds[6 * FB_MAX_EXACT]; /* corrections */
  fb_real C[36 * FB_MAX_EXACT], relaxed[6 * FB_MAX_EXACT];  /* of structural damping (E10.29) */
  fb_real LU[144 * FB_MAX_EXACT], W[72 * FB_MAX_EXACT], L[72 * FB_MAX_EXACT], root[36];
  fb_real y[12 * (FB_MAX_EXACT + 1)];
  fb_real aside[36 * FB_MAX_LUMPS]; /* what eliminated branches leave to the nodes they begin at */
  int perm[12 * FB_MAX_EXACT + 6];
  fbi_exact_cell cell;
  fbi_exact_jacobian jacobian;
  fb_exact_input input;
  fb_exact_state state; /* of the last increment that converged */
};
#endif

#if FB_WITH_BUILD
struct fb_modes_work {
  int held[FBI_MAX_DOF];
  fb_real rigid[6 * FBI_MAX_DOF];                                     /* six rigid motions about the root, rows */
  fb_real free[6 * FBI_MAX_DOF];                                      /* those that the root permits, orthonormal */
  fb_real K[FBI_MAX_ROW * FBI_MAX_DOF], M[FBI_MAX_ROW * FBI_MAX_DOF]; /* assembled, what a row couples with */
  /* Of an eigenproblem: one matrix above the diagonal of A, the factor of the other in the rest; the vectors */
  fb_real A[FBI_MAX_DOF * FBI_MAX_DOF], X[FBI_MAX_DOF * FBI_MAX_DOF];
  fb_real omega2[FBI_MAX_DOF];
  fb_modes found;
};

#define FBI_MAX_JOINED (FB_MAX_COMPONENTS * FB_MAX_MODES)
#define FBI_MAX_WELD_ROWS (6 * FB_MAX_WELDS)
struct fb_join_work {
  fb_real K[FBI_MAX_JOINED * FBI_MAX_JOINED], M[FBI_MAX_JOINED * FBI_MAX_JOINED];
  fb_real Z[FBI_MAX_JOINED * FBI_MAX_JOINED], A[FBI_MAX_JOINED * FBI_MAX_JOINED];
  /* constraints, modes */
  fb_real X[FBI_MAX_JOINED * (FBI_MAX_JOINED > FBI_MAX_WELD_ROWS ? FBI_MAX_JOINED : FBI_MAX_WELD_ROWS)];
  fb_real d[FBI_MAX_JOINED], scale[FBI_MAX_JOINED];
  int pivot[FBI_MAX_JOINED];
  fb_modes joined;
};

struct fb_body_work {
  fb_real L[FB_MAX_MODES * FB_MAX_MODES], A[FB_MAX_MODES * FB_MAX_MODES], B[FB_MAX_MODES * FB_MAX_MODES];
  fb_real X[FB_MAX_MODES * FB_MAX_MODES], d[FB_MAX_MODES];
  fb_real Lambda[(FB_MAX_MODES + 1) * 6 * FB_MAX_MODES];
#if FB_WITH_LARGE_DEFLECTION
  fb_shape rest;
  fbi_line_work line;
#endif
  fb_body body;
};

typedef union fb_build_scratch { /* one at a time */
  fb_modes_work modes;
  fb_join_work join;
  fb_body_work body;
} fb_build_scratch;

struct fb_build_work {
  int part; /* after a failure: the part that failed; -1: the hub, n_part: joining, the body as a whole */
  int n;    /* coordinates so far */
  fb_beam_desc placed;
  fb_beam beam[FB_MAX_PARTS];
  fb_modes modes[FB_MAX_PARTS];
  fb_shape shape;
  fb_body_desc desc;
  fb_build_scratch scratch;
};

#if FB_WITH_FORMS
struct fb_form_work {
  fb_rk4_work rk4;
  fb_implicit_work implicit;
};
#endif
#endif

#if FB_WITH_ANALYSE
/* Internal: part of the work of bodies and systems. */
#define FBI_MAX_COLUMN (FB_MAX_LINEAR + FB_MAX_PORTS + FB_MAX_LINEAR / 2) /* rates, outputs, momenta */
typedef struct fbi_analysis {
  fb_real A[FB_MAX_LINEAR * FB_MAX_LINEAR], X[2 * FB_MAX_LINEAR * FB_MAX_LINEAR];
  fb_real eig[4 * FB_MAX_LINEAR * FB_MAX_LINEAR];
  fb_real re[FB_MAX_LINEAR], im[FB_MAX_LINEAR], step[FB_MAX_LINEAR + FB_MAX_PORTS], scale[FB_MAX_LINEAR / 2];
  fb_real f[FBI_MAX_COLUMN], column[FBI_MAX_COLUMN], wider[FBI_MAX_COLUMN], best[FBI_MAX_COLUMN], miss[FBI_MAX_COLUMN];
  fb_real E[FB_MAX_LINEAR * FB_MAX_LINEAR], other_re[FB_MAX_LINEAR], other_im[FB_MAX_LINEAR];
  fb_real P[FB_MAX_LINEAR * FB_MAX_LINEAR / 4], P_miss[FB_MAX_LINEAR * FB_MAX_LINEAR / 4];
  int perm[FB_MAX_LINEAR / 2], keep[FB_MAX_LINEAR];
  fb_linear_desc none;
  fb_linear linear;
} fbi_analysis;

struct fb_analyse_work {
  fbi_analysis common;
  fb_state state, moved, rate;
  fb_motion steady, motion;
  fb_input input;
#if FB_WITH_LARGE_DEFLECTION
  fb_line_motion point[FB_MAX_LINE_POINTS]; /* of the trimmed state, with distributed loads */
#endif
};

#if FB_WITH_SYSTEM
typedef struct fbi_coordinate { /* coordinate of a system's linear model */
  int body, mode, i;            /* mode: elastic coordinate i of the body, else axis i of its joint */
} fbi_coordinate;

#if FB_WITH_ROTORS
typedef struct fbi_free_rotor { /* a rotor whose momentum is a state of a system's linear model */
  int body, rotor;
  fb_real speed; /* [rad/s] in the steady state */
} fbi_free_rotor;
#endif

struct fb_system_analyse_work {
  fb_system_work system; /* .joint: after a failure the joint that failed */
  fbi_analysis common;
  int n; /* number of coordinates; loops make some dependent: */
  int n_dependent, n_independent, dependent[FB_MAX_ROWS], independent[FB_MAX_LINEAR / 2];
  fbi_coordinate coordinate[FB_MAX_LINEAR / 2];
  fb_real size[FB_MAX_LINEAR / 2], z_dot[FB_MAX_LINEAR / 2], p_dot[FB_MAX_LINEAR / 2], p_moved[FB_MAX_LINEAR / 2];
  fb_real Z[FB_MAX_ROWS * (FB_MAX_LINEAR / 2 + 1)], row_size[FB_MAX_ROWS];
  fb_real steady[FB_MAX_BODIES][6], momenta[FB_MAX_LINEAR / 2]; /* steady speeds of joints, independent momenta */
  fb_real begun[FB_MAX_BODIES][6]; /* place and rotation vector of free joints on springs where a trim begins */
  fb_link_motion rest[FB_MAX_BODIES];
  int n_rotor; /* whose momentum is not given */
#if FB_WITH_ROTORS
  fbi_free_rotor rotor[FB_MAX_BODIES * FB_MAX_ROTORS];
#endif
  fb_system_state state, moved, rate;
  fb_system_motion motion;
  fb_system_input input;
};
#endif

#if FB_WITH_EXACT
typedef struct fbi_exact_loads {
  fb_real line[6 * FB_MAX_EXACT], line_dead[6 * FB_MAX_EXACT], offset[6 * FB_MAX_EXACT];
  fb_real follower[6 * (FB_MAX_EXACT + 1)], dead[6 * (FB_MAX_EXACT + 1)], motor[FB_MAX_LUMPS];
  int n_support;
  fb_support_place support[FB_MAX_LUMPS];
} fbi_exact_loads;

struct fb_exact_path_work {
  fb_exact_work exact;
  fbi_exact_loads constant, varied;
  /* Change of the residuals per unit of the factor */
  fb_real B[6 * (FB_MAX_EXACT + 1)], c[6 * FB_MAX_EXACT], want[6 * (FB_MAX_EXACT + 1)];
  fb_real dd[6 * (FB_MAX_EXACT + 1)], ds[6 * FB_MAX_EXACT]; /* correction at a constant factor */
  fb_real ahead[6 * (FB_MAX_EXACT + 1)];
};

struct fb_exact_spectrum_work {
  fb_exact_work exact;
  fb_real Q[(FBI_EXACT_BASIS + 2) * FBI_EXACT_DIM], x[FBI_EXACT_DIM];
  fb_real H[(FBI_EXACT_BASIS + 2) * FBI_EXACT_BASIS], A[FBI_EXACT_BASIS * FBI_EXACT_BASIS];
  fb_real X[2 * FBI_EXACT_BASIS * FBI_EXACT_BASIS], eig[4 * FBI_EXACT_BASIS * FBI_EXACT_BASIS];
  fb_real re[FBI_EXACT_BASIS], im[FBI_EXACT_BASIS], missing[FBI_EXACT_BASIS];
};

struct fb_exact_linear_work {
  fb_exact_spectrum_work spectrum;
  fb_real base_quat[4], answer[FBI_EXACT_DIM], other[FBI_EXACT_DIM];
  fb_real rest[FB_MAX_PORTS * FBI_EXACT_DIM]; /* answer at rest to the inputs that move supports */
  fb_real basis[FB_EXACT_STATES * FBI_EXACT_DIM], R[FB_EXACT_STATES * FB_EXACT_STATES];
  fb_real right[FB_EXACT_STATES * FBI_EXACT_BASIS], left[FB_EXACT_STATES * FBI_EXACT_BASIS];
  fb_real G[FB_EXACT_STATES * FB_EXACT_STATES], scale[FB_EXACT_STATES], part[FB_EXACT_STATES], sum[FB_EXACT_STATES];
  int perm[FB_EXACT_STATES], order[FBI_EXACT_BASIS];
  fb_exact_linear linear;
};
#endif

typedef struct fbi_advice_modes { /* of a body with some of the coordinates, in a load case */
  fb_real K[FB_MAX_MODES * FB_MAX_MODES], M[FB_MAX_MODES * FB_MAX_MODES], x[FB_MAX_MODES * FB_MAX_MODES];
  fb_real omega[FB_MAX_MODES], zeta[FB_MAX_MODES], part[FB_MAX_MODES]; /* [rad/s], -, of the quasi-static answer */
  fb_real gain[FB_MAX_MODES], give[FB_MAX_MODES][3];                   /* to the output, without gain [m] */
  fb_real free[FB_MAX_MODES];                                          /* free vibration by gain */
} fbi_advice_modes;

struct fb_advice_work {
  fb_body_work body_work;
  fb_body body, full;
  fb_shape shape;
  fb_body_desc desc;
  fb_state state;
  fb_input input;
  fb_motion motion;
  fb_node_motion node;
  fb_spectrum spectrum;
  fb_exponential exponential;
  fb_real K[FB_MAX_MODES * FB_MAX_MODES], scale[FB_MAX_MODES];
  int perm[FB_MAX_MODES];
  int all[FB_MAX_MODES];                        /* 0, 1, ... */
  fb_real inertia[FB_MAX_MODES * FB_MAX_MODES]; /* M of the modes while the base recoils */
  fbi_advice_modes modes;
  /* K q = f of the load cases, K also at rest; forces and output of the full set in phases of the load cases */
  fb_real tangent[FBI_ADVICE_INSTANTS + 1][FB_MAX_MODES * FB_MAX_MODES];
  fb_real f[FBI_ADVICE_INSTANTS][FB_MAX_MODES], q[FBI_ADVICE_INSTANTS][FB_MAX_MODES];
  fb_real q_dot[FBI_ADVICE_INSTANTS][FB_MAX_MODES];
  fb_real force[FBI_ADVICE_INSTANTS][FBI_ADVICE_PHASES][FB_MAX_MODES];
  fb_real displacement[FBI_ADVICE_INSTANTS][FBI_ADVICE_PHASES][3];
  /* of the body with the first n coordinates in that order: highest frequency and largest contribution of each mode of
     its own, row n - 1; its motion in the load cases with all of them */
  fb_real omega[FB_MAX_MODES][FB_MAX_MODES], most[FB_MAX_MODES][FB_MAX_MODES];
  fb_real swing[FB_MAX_MODES][FB_MAX_MODES]; /* free vibration of the contribution */
  fb_real history[FBI_ADVICE_INSTANTS][FBI_ADVICE_TIMES][3];
  int order[FB_MAX_MODES]; /* coordinates in descending order of what they matter to the output, score */
  fb_real score[FB_MAX_MODES], give[FB_MAX_MODES]; /* give: what they give directly */
  fb_real beside[FB_MAX_MODES]; /* what a mode gives to the output by large deflection alone, relative to it */
  fb_real zeta[FB_MAX_MODES], deflection, drawn, ringing;
  fb_real motion_off, linear_off,
      field_off; /* of a set, of the linear one, by the field: acceleration, as statically */
  fb_real bend;  /* [m] the deflection without its limit */
  int buckled;   /* 1: in some load case */
  int has_field; /* 1: lines say what the displacement field errs by, */
  fb_real field; /* relative to the deflection */
#if FB_WITH_ROTORS
  int turns; /* some rotor does */
#endif
  fb_real error[FBI_ADVICE_SETS], error_modes[FB_MAX_MODES];
  fb_real step_cost[FBI_ADVICE_SETS][FB_MAX_MODES][FB_INTEGRATOR_COUNT];
  fb_real longest[FBI_ADVICE_SETS][FB_MAX_MODES][FB_INTEGRATOR_COUNT];
  fb_real last[FBI_ADVICE_SETS][FB_MAX_MODES][FB_INTEGRATOR_COUNT];
  int part[FBI_ADVICE_SETS][FB_MAX_MODES][FB_INTEGRATOR_COUNT];
};
#endif

#endif /* FLEXBEAM_H */

#if defined(FLEXBEAM_IMPLEMENTATION) && !defined(FLEXBEAM_IMPL_INCLUDED)
#define FLEXBEAM_IMPL_INCLUDED
#include "flexbeam_impl.h"
#endif

/* HISTORY
   0.2.0  one grammar: arguments are context (models, the state that changes, work), outputs, inputs, sizes; a function
          that fills a struct ends with a verb, one that returns its number is named by it. RUN, BUILD and ANALYSE with
          switches that remove them; fb_stepper; fb_body_build; axes of joints; fb_detail. A desc with a filled array
          and a count of 0 is refused; so is zeta or gravity without its effect (FB_ERR_EFFECTS), a load without a mode
          of its own (FB_ERR_MODES), a model that is all zero (FB_ERR_INIT). Old names:
            fb_mixed..., FB_MAX_MIXED, FB_MIXED_...       fb_exact..., FB_MAX_EXACT, FB_EXACT_...
            fb_mixed_steady_solve                         fb_exact_trim
            fb_body_motion, _node_motion, _rates,         the same with _eval: fb_body_motion_eval, ...
            _energy, _momentum; fb_system_rates,
            _energy, _momentum; fb_mixed_energy, _momentum
            fb_beam_section, fb_beam_matrices             fb_beam_section_eval, fb_beam_matrices_eval; the beam first
            fb_body_spectrum, fb_system_spectrum          fb_..._spectrum_solve; models, work, spectrum, state, input
            fb_body_linearize, fb_system_, fb_mixed_      the same; models, work, linear, state, input, desc
            fb_mixed_spectrum_solve                       fb_exact_spectrum_solve; exact, work, spectrum, state, ...
            fb_system_state_init, fb_system_axis_set      the same; state before work
            fb_system_init(.., body, n_model, desc)       fb_system_init(.., body, desc, n_model)
            fb_modes_join(.., 9 arguments)                fb_modes_join(joined, work, beam, component, desc,
                                                          n_component) with fb_join_desc
            fb_body_advise, fb_advise_work                fb_advice_solve, fb_advice_work
            fb_scheme, FB_SCHEME_..., advice.scheme       fb_integrator, FB_INTEGRATOR_..., advice.integrator
            fb_spectrum_step                              fb_spectrum_dt
            fb_spectrum_margin(re, mode, n)               fb_spectrum_margin(mode, re, n)
            FB_ERR_KIND                                   split: FB_ERR_KIND, _MODES, _UNREST, _UNSUPPORTED
            fb_exact_port, .at, FB_EXACT_PORT_...,        fb_port, .node, .body of a joint, FB_PORT_...; MOTOR, ANGLE,
            fb_exact_linear_desc                          ANGLE_RATE: DRIVE, COORDINATE, SPEED; fb_linear_desc
            build/flexbeam beam3d                         build/flexbeam exact
            scheme in scenes, --scheme of the examples    integrator, --integrator
            shape.ups, .Gam, .Pi, .Gamchi, .pchi, .hchi,  shape.second.ups, ...
            .reach
          Bodies: beams that bend and twist by any angle (FB_EFFECT_LARGE_DEFLECTION, >>line); fb_rotor, wheels inside
          (fb_state.q and .pi have room for them, fb_body.n_coordinate, FB_PORT_MOTOR, FB_PORT_ROTOR_SPEED), in systems,
          too; gravity of a center with its gradient, circular orbits (fb_body_desc.mu); fb_body_limit_eval,
          fb_body_scale, fb_linear.rate, fb_spectrum_error. Imported models with effects of second degree: fb_shape_add_stiffening,
          fb_fields_init, fb_shape_add_field_lump, fb_shape_add_field_node. FB_WITH_OPTIONAL: default of what one body
          seldom wants; a refused effect names its switch. sizeof(fb_rk4_work) is 1728, was 55800: lines are on the
          stack of a call. Implicit steps: a fast prescribed base that begins to turn does not end in
          FB_ERR_CONVERGENCE.
          FB_MAX_RUNS is gone, FB_MAX_S is room for the terms of S alone; models in ROM are to be made anew.
          Systems: springs and dampers of free joints (fb_joint_desc.stiffness, rest, damping have six numbers); friction
          and stops of joints (fb_joint_desc.friction, friction_speed, stop, stop_stiffness, stop_loss).
          FB_METHOD_MULTIPLIERS is gone: write joints as loops of free bodies. A wheel is fb_rotor: one that
          is a body on a hinge bounds the step by its speed, as every joint does. Refused are prescribed values that
          jump, prescribed rates that contradict a closed loop from 1e-6 of its speeds on (was a hundredth; generated
          code the same), and by fb_system_trim a prescribed axis that moves and changes the equilibrium. Loops at rest
          are no contradiction to an axis that is prescribed elsewhere; they close alike with a dense LU. SDIRK: stiff
          modes that hardly move do not end in FB_ERR_CONVERGENCE; lines without a deflection_limit do where their
          motion has not converged. fb_modes_join in single precision: slow modes of stiff parts are found, or refused.
          Exact beams have joints and branches: fb_exact_desc.joint, .branch, fb_exact_input.motor, fb_exact_joint_eval,
          FB_PORT_DRIVE, _COORDINATE, _SPEED; `joint` in descriptions. Reactions of nodes held beyond the root
          converge with the step. fb_exact_desc.iterations is a bound: in double precision a step ends its corrections
          where the next would be rounding. Follower loads on elements that come at once move no node at once. Free beams on
          one line want inertia about it (FB_ERR_SINGULAR). Work structs are complete at the end of flexbeam.h.
          Supports of exact beams move to places that the input names, fb_exact_input.support, in steps, steady states and
          paths: slack lines are built straight (`move` in descriptions, motion displacement and rotation in scenes); their
          places are inputs of linear models, FB_PORT_SUPPORT_DISPLACEMENT, _ROTATION. Rotary inertia of their sections is
          shared with the nodes.
          Advice ranks modes by the motion of the whole body under its loads, the recoil of the base included; measures
          the quadratic field by the lines, foresees exponential steps with large deflection (fb_envelope.smooth,
          .lasts, fb_advice.line_points), knows rotors (fb_envelope.rotor).
          The forms of [DB] (FB_WITH_FORMS) have functions and a type of their own, fb_form_init, fb_form_step, ..:
          fb_body, fb_body_desc and fb_shape do not depend on it. Of such a body analysis is gone.
          Programs: build/flexbeam reduce --code, the rk4 step of one body as C of its own, with --vary factors of
          stiffness, damping and masses, with --lanes several bodies at once; scene --code, the same of bodies on
          joints. FMUs of scenes: several instances in a process; saved states hold what the model has; derivatives of
          outputs by time, adjoint derivatives; early return, event mode at latches, an icon. Files are written as
          FILE.part and get their name when they are whole.
   0.1.0  one flexible body: beams, modes, momentum form, rk4; nonlinear axial strain, second- and first-order form,
          pinned and hinged bases, implicit midpoint, SDIRK2, exponential scheme; sections with shear, twist and
          centers off the line, bent lines, component modes, buckling, synthesis, finite-element models, complex
          modes; systems of bodies: joints, trees, loops, constraints, strain gauges; the geometrically exact beam;
          steady states, linear models and complex modes of bodies and of systems; paths by arc length; advice on
          effects, modes, integrator and step */
