/* >>status: the record of a refusal, by a private copy of the library with FB_WITH_DETAIL. */
#define FLEXBEAM_STATIC
#define FB_WITH_DETAIL 1
#include "fbt.h"

static fb_material aluminium;
static fb_profile tube;
static fb_section section;
static fb_beam_desc boom;
static fb_beam beam;
static fb_modes_desc keep;
static fb_modes modes;
static fb_modes_work modes_work;
static fb_shape shape;
static fb_body_desc level;
static fb_body body;
static fb_body_work body_work;
static fb_state state;
static fb_input input;
static fb_rk4_work rk4;
static fb_implicit_work implicit;
static fb_system_desc arm;
static fb_system mechanism;
static fb_system_work work;
static fb_system_state turning;
static fb_system_input drive;
static fb_exact_desc rod;
static fb_exact exact;
static fb_exact_state swaying;
static fb_exact_work exact_work;
static fb_stepper stepper;
static fb_stepper_desc way;

/* A boom on a hub and an arm of two of them, all valid. */
static void fresh(void)
{
  const fb_real center[3] = {0}, inertia[6] = {80, 80, 80};
  int node = 0;
  memset(&section, 0, sizeof section);
  section.mass = FB_R(1.2);
  section.EI_y = section.EI_z = 14004;
  memset(&boom, 0, sizeof boom);
  boom.length = 10;
  boom.n_element = 4;
  boom.n_station = 3;
  for (int k = 0; k < 3; k++) {
    boom.station[k] = section;
    boom.station[k].x = (fb_real)(5 * k);
  }
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = 2;
  memset(&level, 0, sizeof level);
  level.effects = FB_EFFECTS_FULL;
  memset(&input, 0, sizeof input);
  memset(&drive, 0, sizeof drive);
  FBT_INT_EQ(fb_beam_init(&beam, &boom), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_rigid(&shape, 500, center, inertia), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, 10), FB_OK);
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);

  memset(&arm, 0, sizeof arm);
  arm.n_body = 2;
  for (int k = 0; k < 2; k++) {
    arm.joint[k].kind = FB_JOINT_REVOLUTE;
    arm.joint[k].parent = k - 1;
    arm.joint[k].parent_node = k;
  }
  memset(&rod, 0, sizeof rod);
  rod.length = 10;
  rod.n_element = 4;
  rod.n_station = 2;
  for (int k = 0; k < 2; k++) {
    FBT_INT_EQ(fb_exact_station_init(&rod.station[k], &section), FB_OK);
    rod.station[k].x = (fb_real)(10 * k);
  }
}

/* The record of a call that gave `status`; what: the words that it begins with. */
static const fb_detail *told(fb_status got, fb_status status, const char *function, const char *what, int index,
                             double have, double need)
{
  const fb_detail *d = fb_detail_last();
  const double size = fabs(have) + fabs(need);
  FBT_INT_EQ(got, status);
  FBT_INT_EQ(d->status, status);
  if (strcmp(d->function, function) != 0 || strncmp(d->what, what, strlen(what)) != 0) {
    printf("  %s: %s; expected %s: %s\n", d->function, d->what, function, what);
  }
  FBT_TRUE(strcmp(d->function, function) == 0);
  FBT_TRUE(strncmp(d->what, what, strlen(what)) == 0);
  FBT_INT_EQ(d->index, index);
  FBT_NEAR_ABS((double)d->have, have, 1e-6 * size);
  FBT_NEAR_ABS((double)d->need, need, 1e-6 * size);
  return d;
}

/* Interface: at first there is none, and a success leaves the last one. */
TEST(a_success_leaves_the_record_of_the_last_refusal)
{
  FBT_TRUE(fb_detail_last() != NULL);
  FBT_TRUE(fb_detail_last()->status != FB_OK || strcmp(fb_detail_last()->what, "") == 0);
  fresh();
  (void)told(fb_shape_init(&shape, -1), FB_ERR_VALUE, "fb_shape_init", "n, at least", -1, -1.0, 0.0);
  (void)told(fb_shape_init(&shape, FB_MAX_MODES + 8), FB_ERR_CAPACITY, "fb_shape_init", "n, FB_MAX_MODES, at most", -1,
             FB_MAX_MODES + 8.0, FB_MAX_MODES);
  FBT_INT_EQ(fb_shape_init(&shape, 1), FB_OK);
  FBT_TRUE(strcmp(fb_detail_last()->function, "fb_shape_init") == 0);
  (void)told(fb_beam_init(NULL, &boom), FB_ERR_NULL, "fb_beam_init", "beam && desc", -1, 0.0, 0.0);
}

/* Interface: sections, beams and their modes name the station, the field, what it is and what it must be. */
TEST(refused_beams_name_the_station_and_the_field)
{
  const char *const init = "fb_beam_init";
  fresh();
  aluminium.E = aluminium.G = FB_R(7e10);
  aluminium.density = -2700;
  tube.kind = FB_PROFILE_TUBE;
  tube.size[0] = FB_R(0.1);
  (void)told(fb_section_init(&section, &aluminium, &tube), FB_ERR_VALUE, "fb_section_init",
             "material.density [kg/m^3], at least", -1, -2700.0, 0.0);
  aluminium.density = 2700;
  tube.size[1] = FB_R(0.2);
  (void)told(fb_section_init(&section, &aluminium, &tube), FB_ERR_VALUE, "fb_section_init", "profile.size[1]", -1, 0.2,
             0.1);
  boom.station[2].EI_y = -3;
  (void)told(fb_beam_init(&beam, &boom), FB_ERR_VALUE, init, "station: EI_y [N m^2], at least", 2, -3.0, 0.0);
  boom.station[2].EI_y = (fb_real)NAN;
  FBT_INT_EQ(fb_beam_init(&beam, &boom), FB_ERR_NOT_FINITE);
  FBT_TRUE(strcmp(fb_detail_last()->what, "station: EI_y [N m^2], at least") == 0 && fb_detail_last()->index == 2);
  FBT_TRUE(fb_detail_last()->have != fb_detail_last()->have); /* NaN */
  fresh();
  boom.station[2].x = 9;
  (void)told(fb_beam_init(&beam, &boom), FB_ERR_VALUE, init, "station: x [m] of the last", 2, 9.0, 10.0);
  boom.station[1].x = 0;
  (void)told(fb_beam_init(&beam, &boom), FB_ERR_VALUE, init, "station: x [m] after that of the station before", 1, 0.0,
             0.0);
  boom.n_element = FB_MAX_ELEMENTS + 3;
  (void)told(fb_beam_init(&beam, &boom), FB_ERR_CAPACITY, init, "n_element, FB_MAX_ELEMENTS, at most", -1,
             FB_MAX_ELEMENTS + 3.0, FB_MAX_ELEMENTS);
  fresh();
  boom.n_lump = 2;
  boom.lump[1].mass = -1;
  (void)told(fb_beam_init(&beam, &boom), FB_ERR_VALUE, init, "lump: mass [kg], at least", 1, -1.0, 0.0);
  boom.lump[1].mass = 1;
  boom.lump[1].node = 5;
  (void)told(fb_beam_init(&beam, &boom), FB_ERR_CAPACITY, init, "lump: node, beyond", 1, 5.0, 4.0);
  fresh();
  boom.length = 0;
  (void)told(fb_beam_init(&beam, &boom), FB_ERR_VALUE, init, "length [m], above", -1, 0.0, 0.0);
}

/* Interface: modes that a beam cannot have name the stiffness that is missing. */
TEST(refused_modes_name_what_the_beam_lacks)
{
  const char *const solve = "fb_modes_solve";
  fresh();
  keep.count[FB_KIND_TORSION] = 1;
  (void)told(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_ERR_KIND, solve,
             "kind: torsion modes asked for, GJ [N m^2]", FB_KIND_TORSION, 0.0, 0.0);
  keep.count[FB_KIND_TORSION] = 0;
  for (int k = 0; k < 3; k++) {
    boom.station[k].EI_z = 0;
  }
  FBT_INT_EQ(fb_beam_init(&beam, &boom), FB_OK);
  (void)told(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_ERR_KIND, solve,
             "kind: bending modes along y asked for, EI_z [N m^2]", FB_KIND_BEND_Y, 0.0, 0.0);
  fresh();
  keep.mass_fraction = FB_R(1.5);
  (void)told(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_ERR_VALUE, solve, "mass_fraction, beyond", -1, 1.5,
             1.0);
  fresh();
  keep.lowest = 2;
  keep.spin = 3;
  (void)told(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_ERR_VALUE, solve, "spin, not with lowest", -1, 0.0,
             0.0);
  fresh();
  (void)told(fb_buckling_solve(&modes, &modes_work, &beam, &keep), FB_ERR_VALUE, "fb_buckling_solve", "preload", -1,
             0.0, 0.0);
}

/* Interface: shapes and bodies name argument, mode or node. */
TEST(refused_bodies_name_the_field_and_the_mode)
{
  const fb_real center[3] = {0}, rod_alone[6] = {10, 1, 1};
  int node;
  fresh();
  (void)told(fb_shape_add_rigid(&shape, -5, center, rod_alone), FB_ERR_VALUE, "fb_shape_add_rigid",
             "mass [kg], at least", -1, -5.0, 0.0);
  (void)told(fb_shape_add_rigid(&shape, 5, center, rod_alone), FB_ERR_VALUE, "fb_shape_add_rigid", "inertia", -1, 10.0,
             2.0);
  (void)told(fb_shape_add_beam(&shape, 3, &beam, &modes), FB_ERR_CAPACITY, "fb_shape_add_beam", "first, 0 to", -1, 3.0,
             0.0);
  (void)told(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, 11), FB_ERR_VALUE, "fb_shape_add_beam_node",
             "x [m] along the beam", -1, 11.0, 10.0);
  level.effects |= FB_EFFECT_DAMPING;
  level.zeta[2] = FB_R(-0.01);
  (void)told(fb_body_init(&body, &body_work, &shape, &level), FB_ERR_VALUE, "fb_body_init", "mode: damping ratio zeta",
             2, -0.01, 0.0);
  level.zeta[2] = FB_R(0.01);
  level.effects = FB_EFFECTS_FULL;
  (void)told(fb_body_init(&body, &body_work, &shape, &level), FB_ERR_EFFECTS, "fb_body_init",
             "mode: damping ratio zeta, without FB_EFFECT_DAMPING", 2, 0.01, 0.0);
  level.zeta[2] = 0;
  level.gravity[2] = -9;
  (void)told(fb_body_init(&body, &body_work, &shape, &level), FB_ERR_EFFECTS, "fb_body_init",
             "gravity, its size [m/s^2], without FB_EFFECT_GRAVITY", -1, 9.0, 0.0);
}

/* Interface: bases tell how many modes were asked for, and how many there may be. */
TEST(refused_bases_tell_the_number_of_modes)
{
  const char *const solve = "fb_modes_solve", *const room = "count of modes, FB_MAX_MODES, at most";
  const double most = FB_MAX_MODES;
  fresh();
  boom.n_element = FB_MAX_ELEMENTS;
  for (int k = 0; k < 3; k++) {
    boom.station[k].EA = FB_R(1e7);
    keep.count[k] = FB_MAX_MODES / 3 + 1;
  }
  FBT_INT_EQ(fb_beam_init(&beam, &boom), FB_OK);
  (void)told(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_ERR_CAPACITY, solve, room, -1,
             3.0 * (FB_MAX_MODES / 3 + 1), most);
  keep.lowest = FB_MAX_MODES + 8;
  (void)told(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_ERR_CAPACITY, solve, room, -1, most + 8, most);
  keep.lowest = 0;
  keep.basis = FB_BASIS_FUNCTIONS;
  (void)told(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_ERR_CAPACITY, solve, room, -1,
             3.0 * (FB_MAX_MODES / 3 + 1), most);
  keep.degree = 2;
  (void)told(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_ERR_VALUE, solve, "degree, beyond", -1, 2.0, 3.0);
  keep.degree = 3;
  keep.count[FB_KIND_BEND_Y] = 100;
  (void)told(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_ERR_MODES, solve, "kind: count of functions",
             FB_KIND_BEND_Y, 2.0 * FB_MAX_ELEMENTS, 100.0);
  fresh();
  boom.n_element = 1;
  FBT_INT_EQ(fb_beam_init(&beam, &boom), FB_OK);
  keep.count[FB_KIND_BEND_Y] = 4; /* all that one element has */
  keep.n_load = 2;
  keep.load[0].node = keep.load[1].node = 1;
  keep.load[0].axis = 2;
  keep.load[1].axis = 1;
  (void)told(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_ERR_MODES, solve, "load: modes with its deflection",
             1, 7.0, 8.0);
  fresh();
  keep.line_points = 1;
  (void)told(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_ERR_VALUE, solve, "line_points, 0 or at least", -1,
             1.0, 2.0);
  keep.line_points = 0;
  keep.preload.force = (fb_real)-1e6;
  (void)told(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_ERR_SINGULAR, solve, "kind: stiffness of its modes",
             FB_KIND_BEND_Y, 0.0, 0.0);
}

/* Interface: what is singular tells about which axis inertia is missing, and at which joint. */
TEST(missing_inertia_is_named_by_its_axis)
{
  const char *const word = "axis: mass [kg] along it (0 to 2), inertia [kg m^2] about it (3 to 5)";
  const fb_detail *d;
  fresh();
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &beam, &modes), FB_OK);
  for (int k = 0; k < 2; k++) { /* about the line of the beam */
    level.base = k ? FB_BASE_PINNED : FB_BASE_FREE;
    FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_ERR_SINGULAR);
    d = fb_detail_last();
    FBT_TRUE(strncmp(d->what, word, strlen(word)) == 0 && strcmp(d->function, "fb_body_init") == 0);
    FBT_INT_EQ(d->index, 3);
    FBT_TRUE(d->have <= d->need);
  }
  level.base = FB_BASE_PRESCRIBED;
  FBT_INT_EQ(fb_body_init(&body, &body_work, &shape, &level), FB_OK);
  arm.n_body = 1;
  arm.joint[0].parent = FB_GROUND;
  for (int k = 0; k < 3; k++) {
    arm.joint[0].kind = k == 2 ? FB_JOINT_SPHERICAL : FB_JOINT_FREE;
    arm.method = k == 1 ? FB_METHOD_DENSE : FB_METHOD_RECURSIVE;
    (void)told(fb_system_init(&mechanism, &work, &body, &arm, 1), FB_ERR_SINGULAR, "fb_system_init",
               "joint: mass or inertia that its free axes move", k == 1 ? -1 : 0, 0.0, 0.0); /* dense: not which */
  }
}

/* Interface: of several parts the record names the one. */
TEST(a_refused_part_is_named_with_what_it_lacks)
{
  static fb_build_work build;
  static fb_build_desc whole;
  fresh();
  memset(&whole, 0, sizeof whole);
  whole.mass = 500;
  whole.inertia[0] = whole.inertia[1] = whole.inertia[2] = 80;
  whole.body = level;
  whole.n_part = 2;
  whole.part[1].n_node = 1;
  whole.part[1].node[0] = 12;
  (void)told(fb_body_build(&body, &build, &whole, &boom, &keep, 1), FB_ERR_VALUE, "fb_shape_add_beam_node",
             "x [m] along the beam", -1, 12.0, 10.0);
  FBT_INT_EQ(fb_detail_last()->part, 1);

  /* roots that are not attached, or twice */
  whole.n_part = 1;
  boom.root = FB_ROOT_PINNED;
  (void)told(fb_body_build(&body, &build, &whole, &boom, &keep, 1), FB_ERR_VALUE, "fb_body_build",
             "part: pinned root, natural modes without", 0, 0.0, 0.0);
  boom.root = FB_ROOT_FREE;
  keep.rigid = 1;
  (void)told(fb_body_build(&body, &build, &whole, &boom, &keep, 1), FB_ERR_VALUE, "fb_body_build",
             "part: free root without a weld", 0, 0.0, 0.0);
  boom.root = FB_ROOT_CLAMPED;
  keep.rigid = 0;
  whole.n_part = 2;
  whole.part[1].n_node = 0;
  whole.part[1].node[0] = 0;
  whole.part[1].position[0] = boom.length;
  whole.join.n_weld = 1;
  whole.join.weld[0].component[1] = 1;
  whole.join.weld[0].node[0] = boom.n_element;
  (void)told(fb_body_build(&body, &build, &whole, &boom, &keep, 1), FB_ERR_VALUE, "fb_body_build",
             "part: clamped root with a weld there", 1, 0.0, 0.0);
}

/* Interface: an array whose count was forgotten is not taken for none: every pair of a description that is read
   once. */
TEST(filled_arrays_without_their_count_are_refused)
{
  static fb_build_work build;
  static fb_build_desc whole;
  fresh();
  boom.lump[0].mass = 3;
  (void)told(fb_beam_init(&beam, &boom), FB_ERR_VALUE, "fb_beam_init", "n_lump, 1 where lump[0]", -1, 0.0, 1.0);
  boom.lump[0].mass = 0;
  boom.point[1][0] = FB_R(2.5);
  (void)told(fb_beam_init(&beam, &boom), FB_ERR_VALUE, "fb_beam_init", "n_point, n_element + 1 where", -1, 0.0, 5.0);
  boom.point[1][0] = 0;
  keep.load[0].node = 4;
  (void)told(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_ERR_VALUE, "fb_modes_solve",
             "n_load, 1 where load[0]", -1, 0.0, 1.0);
  keep.load[0].node = 0;
  keep.boundary[0].axis = 1;
  (void)told(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_ERR_VALUE, "fb_modes_solve",
             "n_boundary, 1 where boundary[0]", -1, 0.0, 1.0);
  keep.n_boundary = 1;
  (void)told(fb_modes_solve(&modes, &modes_work, &beam, &keep), FB_ERR_VALUE, "fb_modes_solve",
             "n_boundary, without FB_BASIS_COMPONENT", -1, 1.0, 0.0);
  keep.n_boundary = keep.boundary[0].axis = 0;

  /* Parts, their nodes, what joins them; rotors */
  memset(&whole, 0, sizeof whole);
  whole.mass = 500;
  whole.inertia[0] = whole.inertia[1] = whole.inertia[2] = 80;
  whole.part[0].position[0] = 1;
  (void)told(fb_body_build(&body, &build, &whole, &boom, &keep, 1), FB_ERR_VALUE, "fb_body_build",
             "n_part, 1 where part[0]", -1, 0.0, 1.0);
  whole.n_part = 2;
  whole.part[1].node[0] = 10;
  (void)told(fb_body_build(&body, &build, &whole, &boom, &keep, 1), FB_ERR_VALUE, "fb_body_build",
             "part: n_node, 1 where node[0]", 1, 0.0, 1.0);
  whole.part[1].n_node = 1;
  whole.join.weld[0].component[1] = 1;
  (void)told(fb_body_build(&body, &build, &whole, &boom, &keep, 1), FB_ERR_VALUE, "fb_modes_join",
             "n_weld, 1 where weld[0]", -1, 0.0, 1.0);
  whole.join.weld[0].component[1] = 0;
  whole.body.rotor[0].inertia = FB_R(0.1);
  (void)told(fb_body_build(&body, &build, &whole, &boom, &keep, 1), FB_ERR_VALUE, "fb_body_init",
             "n_rotor, 1 where rotor[0]", -1, 0.0, 1.0);
  whole.body.rotor[0].inertia = 0;
  FBT_INT_EQ(fb_body_build(&body, &build, &whole, &boom, &keep, 1), FB_OK);

  /* Systems and exact beams */
  arm.loop[0].kind = FB_JOINT_REVOLUTE;
  (void)told(fb_system_init(&mechanism, &work, &body, &arm, 1), FB_ERR_VALUE, "fb_system_init",
             "n_loop, 1 where loop[0]", -1, 0.0, 1.0);
  arm.loop[0].kind = FB_JOINT_FREE;
  arm.spring[0].stiffness = 5;
  (void)told(fb_system_init(&mechanism, &work, &body, &arm, 1), FB_ERR_VALUE, "fb_system_init",
             "n_spring, 1 where spring[0]", -1, 0.0, 1.0);
  rod.lump[0].mass = 3;
  (void)told(fb_exact_init(&exact, &rod), FB_ERR_VALUE, "fb_exact_init", "n_lump, 1 where lump[0]", -1, 0.0, 1.0);
  rod.lump[0].mass = 0;
  rod.support[0].held = FB_END_PINNED;
  (void)told(fb_exact_init(&exact, &rod), FB_ERR_VALUE, "fb_exact_init", "n_support, 1 where support[0]", -1, 0.0, 1.0);
  rod.support[0].held = 0;
  rod.joint[0].element = 1;
  (void)told(fb_exact_init(&exact, &rod), FB_ERR_VALUE, "fb_exact_init", "n_joint, 1 where joint[0]", -1, 0.0, 1.0);
}

/* Interface: steps of one body name the step, its limit and the spin; loads and ranges their number. */
TEST(refused_steps_name_the_limit)
{
  const fb_detail *d;
  const fb_real v[3] = {0}, w[3] = {0, 0, 2}, q_dot[4] = {0};
  fb_real limit, pull;
  fresh();
  pull = 4 * body.c[0] / body.mass; /* of O, about the mass center */
  FBT_INT_EQ(fb_state_from_velocity(&body, &state, v, w, q_dot), FB_OK);
  limit = fb_rk4_limit(&body, 2, pull);
  d = told(fb_rk4_step(&body, &state, &rk4, &input, &input, &input, 1), FB_ERR_STEP, "fb_rk4_step",
           "dt [s] for the modes at this spin [rad/s], at most", -1, 1.0, (double)limit);
  FBT_NEAR_ABS((double)d->at, 2.0, 1e-4);
  limit = fb_implicit_limit(&body, 2, pull);
  d = told(fb_midpoint_step(&body, &state, &implicit, &input, 1, 2), FB_ERR_STEP, "fb_midpoint_step",
           "dt [s] at this spin [rad/s], at most", -1, 1.0, (double)limit);
  FBT_NEAR_ABS((double)d->at, 2.0, 1e-4);
  (void)told(fb_sdirk_step(&body, &state, &implicit, &input, &input, 1, 2), FB_ERR_STEP, "fb_sdirk_step",
             "dt [s] at this spin", -1, 1.0, (double)limit);
  (void)told(fb_rk4_step(&body, &state, &rk4, &input, &input, &input, 0), FB_ERR_VALUE, "fb_rk4_step", "dt [s]", -1,
             0.0, 0.0);
  input.n_load = 2;
  input.load[1].node = 5;
  (void)told(fb_rk4_step(&body, &state, &rk4, &input, &input, &input, FB_R(1e-4)), FB_ERR_CAPACITY, "fb_rk4_step",
             "node", 1, 5.0, (double)body.n_node);
  input.load[1].node = 0;
  input.load[1].force[0] = (fb_real)INFINITY;
  (void)told(fb_rk4_step(&body, &state, &rk4, &input, &input, &input, FB_R(1e-4)), FB_ERR_NOT_FINITE, "fb_rk4_step",
             "load: force", 1, 0.0, 0.0);
  input.n_load = 0;
  memset(&state, 0, sizeof state); /* nobody made it */
  d = told(fb_rk4_step(&body, &state, &rk4, &input, &input, &input, FB_R(1e-4)), FB_ERR_STEP, "fb_rk4_step",
           "state: finite numbers and a quaternion of length 1", -1, 0.0, 0.0);
  FBT_NEAR_ABS((double)d->at, 0.0, 0.0);
  (void)told(fb_midpoint_step(&body, &state, &implicit, &input, FB_R(1e-4), 2), FB_ERR_STEP, "fb_midpoint_step",
             "state: finite numbers", -1, 0.0, 0.0);
  (void)told(fb_state_check(&body, &state), FB_ERR_VALUE, "fb_state_check", "state: length squared", -1, 0.0, 1.0);
  FBT_INT_EQ(fb_state_init(&body, &state), FB_OK);
  state.q[3] = 1000;
  d = told(fb_state_check(&body, &state), FB_ERR_RANGE, "fb_state_check", "mode: has the largest share", 3,
           (double)(1000 * body.reach[3]), (double)body.deflection_limit);
  FBT_NEAR_ABS((double)d->at, 1000.0, 1e-3);
}

/* Interface: steppers name what of their description is refused. */
TEST(refused_steppers_name_the_field)
{
  const char *const init = "fb_stepper_init";
  static fb_exponential exponential;
  fresh();
  memset(&way, 0, sizeof way);
  way.body = &body;
  way.state = &state;
  (void)told(fb_stepper_init(&stepper, &way), FB_ERR_VALUE, init, "dt [s], finite and above", -1, 0.0, 0.0);
  way.dt = FB_R(0.01);
  way.iterations = 51;
  (void)told(fb_stepper_init(&stepper, &way), FB_ERR_VALUE, init, "iterations, 0 to 50, beyond", -1, 51.0, 50.0);
  way.iterations = 0;
  way.n_input = 2;
  (void)told(fb_stepper_init(&stepper, &way), FB_ERR_VALUE, init, "n_input, 0, 1 or 3", -1, 0.0, 0.0);
  way.n_input = 0;
  way.integrator = FB_INTEGRATOR_EXPONENTIAL;
  way.exponential = &exponential;
  FBT_INT_EQ(fb_exponential_init(&exponential, &body_work, &body, FB_R(0.02)), FB_OK);
  (void)told(fb_stepper_init(&stepper, &way), FB_ERR_VALUE, init, "dt [s], that of the exponential, equal to", -1, 0.01,
             0.02);
  way.integrator = FB_INTEGRATOR_COUNT;
  (void)told(fb_stepper_init(&stepper, &way), FB_ERR_VALUE, init, "integrator, an fb_integrator, beyond", -1,
             (double)FB_INTEGRATOR_COUNT, (double)FB_INTEGRATOR_COUNT - 1.0);
  way.integrator = FB_INTEGRATOR_MIDPOINT;
  way.system = &mechanism;
  (void)told(fb_stepper_init(&stepper, &way), FB_ERR_VALUE, init, "body, system or exact beam: one of them", -1, 0.0,
             0.0);
  way.state = NULL;
  way.exponential = NULL;
  way.system_state = &turning;
  way.system_work = &work;
  (void)told(fb_stepper_init(&stepper, &way), FB_ERR_UNSUPPORTED, init,
             "integrator of a system, FB_INTEGRATOR_RK4 or _SDIRK", -1, 0.0, 0.0);
  memset(&way, 0, sizeof way);
  way.exact = &exact;
  way.exact_state = &swaying;
  way.exact_work = &exact_work;
  way.integrator = FB_INTEGRATOR_SDIRK;
  (void)told(fb_stepper_init(&stepper, &way), FB_ERR_UNSUPPORTED, init, "integrator of an exact beam", -1, 0.0, 0.0);
}

/* Interface: descs of systems name joint and field; a step beyond the limit the body or joint that bounds it. */
TEST(refused_systems_name_the_joint_and_what_bounds_a_step)
{
  const char *const init = "fb_system_init", *const step = "fb_system_rk4_step";
  static fb_link_motion start[FB_MAX_BODIES];
  static fb_system_input later;
  const fb_detail *d;
  fresh();
  arm.joint[1].stiffness[0] = -7;
  (void)told(fb_system_init(&mechanism, &work, &body, &arm, 1), FB_ERR_VALUE, init, "joint: stiffness", 1, -7.0, 0.0);
  arm.joint[1].stiffness[0] = 0;
  arm.joint[1].damping[2] = (fb_real)INFINITY;
  FBT_INT_EQ(fb_system_init(&mechanism, &work, &body, &arm, 1), FB_ERR_NOT_FINITE);
  d = fb_detail_last();
  FBT_TRUE(strncmp(d->what, "joint: damping", 14) == 0 && d->index == 1 && d->at == FB_R(2.0));
  arm.joint[1].damping[2] = 0;
  arm.joint[1].parent = 1;
  (void)told(fb_system_init(&mechanism, &work, &body, &arm, 1), FB_ERR_VALUE, init, "joint: parent", 1, 1.0, 0.0);
  arm.joint[1].parent = 0;
  arm.joint[1].parent_node = 2;
  (void)told(fb_system_init(&mechanism, &work, &body, &arm, 1), FB_ERR_CAPACITY, init, "joint: parent_node", 1, 2.0,
             1.0);
  arm.joint[1].parent_node = 1;

  /* Modes of a body, a stiff spring, the spin */
  for (int k = 0; k < 3; k++) {
    memset(start, 0, sizeof start);
    arm.joint[1].stiffness[0] = k == 1 ? FB_R(1e9) : FB_R(0.0);
    start[0].speed[0] = k == 2 ? FB_R(1e4) : FB_R(0.0);
    FBT_INT_EQ(fb_system_init(&mechanism, &work, &body, &arm, 1), FB_OK);
    FBT_INT_EQ(fb_system_state_init(&mechanism, &body, &turning, &work, start, &drive), FB_OK);
    FBT_INT_EQ(fb_system_rk4_step(&mechanism, &body, &turning, &work, &drive, &drive, &drive, 1), FB_ERR_STEP);
    d = fb_detail_last();
    FBT_TRUE(strcmp(d->function, step) == 0 && d->have == FB_R(1.0) && d->need > FB_R(0.0) && d->need < d->have);
    FBT_TRUE(strncmp(d->what, k == 1 ? "joint: dt [s] for its spring" : "body: dt [s] for its", 20) == 0);
    FBT_TRUE(k == 1 ? d->index == 1 : d->index >= 0);
    FBT_NEAR_ABS((double)d->at, (double)start[0].speed[0], 1e-3 * (double)start[0].speed[0]);
  }
  FBT_INT_EQ(fb_system_sdirk_step(&mechanism, &body, &turning, &work, &drive, &drive, 1, 2), FB_ERR_STEP);
  FBT_TRUE(strcmp(fb_detail_last()->function, "fb_system_sdirk_step") == 0);

  /* A prescribed axis that does not move, although its rate says so */
  arm.joint[1].stiffness[0] = 0;
  arm.joint[1].mode[0] = FB_AXIS_PRESCRIBED;
  later = drive;
  drive.drive[1].rate[0] = later.drive[1].rate[0] = FB_R(0.25);
  FBT_INT_EQ(fb_system_init(&mechanism, &work, &body, &arm, 1), FB_OK);
  FBT_INT_EQ(fb_system_state_init(&mechanism, &body, &turning, &work, NULL, &drive), FB_OK);
  (void)told(fb_system_rk4_step(&mechanism, &body, &turning, &work, &drive, &drive, &later, FB_R(1e-4)),
             FB_ERR_CONTRADICTION, step, "joint: rate of a prescribed axis whose value does not change", 1, 0.25, 0.0);
}

/* Interface: descs of exact beams name station, support, element. */
TEST(refused_exact_beams_name_the_station)
{
  const char *const init = "fb_exact_init";
  fresh();
  rod.dissipation = FB_R(0.8);
  (void)told(fb_exact_init(&exact, &rod), FB_ERR_VALUE, init, "dissipation, 0 to 2/3, beyond", -1, 0.8, 2.0 / 3.0);
  rod.dissipation = 0;
  rod.station[1].stiffness[7 * 4] = -2;
  FBT_NEAR_ABS((double)told(fb_exact_init(&exact, &rod), FB_ERR_VALUE, init,
                            "station: stiffness on the diagonal, at least", 1, -2.0, 0.0)
                   ->at,
               4.0, 0.0);
  fresh();
  rod.station[1].x = 9;
  (void)told(fb_exact_init(&exact, &rod), FB_ERR_VALUE, init, "station: x [m] of the last", 1, 9.0, 10.0);
  fresh();
  rod.n_support = 1;
  rod.support[0].node = 5;
  (void)told(fb_exact_init(&exact, &rod), FB_ERR_CAPACITY, init, "support: node, beyond", 0, 5.0, 4.0);
  fresh();
  rod.n_station = 0;
  (void)told(fb_exact_init(&exact, &rod), FB_ERR_CAPACITY, init, "n_station", -1, 0.0, 1.0);
}

/* A rod with two branches at its middle, all valid: elements 4 to 6 and 7, 8. */
static fb_exact_branch *branched(void)
{
  fresh();
  rod.n_branch = 2;
  for (int b = 0; b < 2; b++) {
    rod.branch[b].node = 2;
    rod.branch[b].n_element = 3 - b;
    rod.branch[b].attitude[0] = rod.branch[b].attitude[3] = 1;
  }
  FBT_INT_EQ(fb_exact_init(&exact, &rod), FB_OK);
  return &rod.branch[1];
}

/* Interface: descs of exact beams name the branch, and of what is on it the station, node or element. */
TEST(refused_branches_are_named)
{
  const char *const init = "fb_exact_init";
  const double rest = FB_MAX_EXACT - 7;
  branched()->node = 8;
  (void)told(fb_exact_init(&exact, &rod), FB_ERR_CAPACITY, init, "branch: node", 1, 8.0, 7.0);
  branched()->n_element = FB_MAX_EXACT;
  (void)told(fb_exact_init(&exact, &rod), FB_ERR_CAPACITY, init, "branch: n_element", 1, FB_MAX_EXACT, rest);
  branched()->n_station = -1;
  (void)told(fb_exact_init(&exact, &rod), FB_ERR_CAPACITY, init, "branch: n_station", 1, -1.0, 0.0);
  branched()->n_station = 1;
  rod.branch[1].station = FB_MAX_STATIONS;
  (void)told(fb_exact_init(&exact, &rod), FB_ERR_CAPACITY, init, "branch: station", 1, FB_MAX_STATIONS,
             FB_MAX_STATIONS - 1);
  branched()->length = -3;
  (void)told(fb_exact_init(&exact, &rod), FB_ERR_VALUE, init, "branch: length [m]", 1, -3.0, 0.0);
  branched()->length = 9;
  (void)told(fb_exact_init(&exact, &rod), FB_ERR_VALUE, init, "station: x [m] of the last, the length", 1, 10.0, 9.0);
  branched()->n_element = 1;
  (void)told(fb_exact_init(&exact, &rod), FB_ERR_VALUE, init, "joints, with that of a branch", 1, 1.0, 1.0);
  branched();
  rod.n_support = 1;
  rod.support[0].node = 8;
  rod.support[0].held = FB_END_PINNED;
  (void)told(fb_exact_init(&exact, &rod), FB_ERR_VALUE, init, "branch: node outboard of its attitude, not held", 1, 0.0,
             0.0);
  branched();
  rod.place[8] = 1;
  rod.place[9] = 10;
  (void)told(fb_exact_init(&exact, &rod), FB_ERR_VALUE, init, "node: place [m] of both ends of a joint", 8, 1.0, 0.0);
  branched();
  rod.n_joint = 1;
  rod.joint[0].element = 7;
  rod.joint[0].axis[0] = 1;
  (void)told(fb_exact_init(&exact, &rod), FB_ERR_VALUE, init, "joint: element, not that of another joint", 0, 0.0, 0.0);
  branched();
  rod.n_branch = FB_MAX_LUMPS + 1;
  (void)told(fb_exact_init(&exact, &rod), FB_ERR_CAPACITY, init, "n_branch", -1, FB_MAX_LUMPS + 1, FB_MAX_LUMPS);
  branched();
  rod.n_joint = FB_MAX_LUMPS - 1;
  (void)told(fb_exact_init(&exact, &rod), FB_ERR_CAPACITY, init, "n_joint and branches with an attitude", -1,
             FB_MAX_LUMPS + 1, FB_MAX_LUMPS);
}

SUITE(status_detail, RUN(a_success_leaves_the_record_of_the_last_refusal),
      RUN(refused_beams_name_the_station_and_the_field), RUN(refused_modes_name_what_the_beam_lacks),
      RUN(refused_bodies_name_the_field_and_the_mode), RUN(refused_bases_tell_the_number_of_modes),
      RUN(missing_inertia_is_named_by_its_axis), RUN(a_refused_part_is_named_with_what_it_lacks),
      RUN(filled_arrays_without_their_count_are_refused), RUN(refused_steps_name_the_limit),
      RUN(refused_steppers_name_the_field), RUN(refused_systems_name_the_joint_and_what_bounds_a_step),
      RUN(refused_exact_beams_name_the_station), RUN(refused_branches_are_named))
