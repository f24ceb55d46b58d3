/* Every integrator on a valid body, system or exact beam of the bytes' choice, and the path of the beam's steady
   states, with plausible and absurd states, inputs and steps. A step that fails leaves the state as it was, one that
   does not leaves it finite; then the motion is finite, or a status says why not. Every fourth step is repeated by
   fb_stepper: the same status, the same bits. */
#define FB_MAX_MODES 7
#define FB_MAX_NODES 3
#define FB_MAX_LOADS 2
#define FB_MAX_ELEMENTS 2
#define FB_MAX_STATIONS 2
#define FB_MAX_LUMPS 2
#define FB_MAX_BODIES 3
#define FB_MAX_LOOPS 1
#define FB_MAX_ROWS 20
#define FB_MAX_SPEEDS 39
#define FB_MAX_EXACT 8
#define FB_MAX_POINTS 16
#define FB_MAX_LINES 1
#define FB_WITH_FORMS 1
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"
#include "fuzz.h"

static fb_beam beam;
static fb_modes modes;
static fb_modes_work modes_work;
static fb_shape shape;
static fb_body body;
static fb_form_body formed; /* in another form than the momentum form, if `form` says so; body: its tables */
static fb_form_work form_work;
static fb_form form;
static fb_body_work body_work;
static fb_state state;
static fb_rk4_work rk4_work;
static fb_implicit_work implicit_work;
static fb_exponential exponential;
static fb_exponential_work exponential_work;
static fb_system links;
static fb_system_work system_work;
static fb_system_state system_state;
static fb_exact exact;
static fb_exact_state exact_state;
static fb_exact_work exact_work;
static fb_exact_path path;
static fb_exact_path_work path_work;

/* Repeats by fb_stepper a step that took a state of `size` bytes from `before` to what it is now, with `status`. What
   fb_stepper_init refuses: a state that does not pass its check, `fit`, or numbers out of their range. */
static void step_again(const fb_stepper_desc *way, void *now, const void *before, size_t size, fb_status status,
                       fb_status fit)
{
  static fb_stepper stepper;
  static union {
    fb_state body;
    fb_system_state system;
    fb_exact_state exact;
  } after;
  const int in_range = way->dt > FB_R(0.0) && way->dt < FB_HUGE && way->iterations >= 0 && way->iterations <= 50;
  fb_status again;
  memcpy(&after, now, size);
  memcpy(now, before, size);
  again = fb_stepper_init(&stepper, way);
  promise(again == (fit != FB_OK ? fit
                    : in_range   ? FB_OK
                                 : FB_ERR_VALUE),
          "another status than that of its reason", "fb_stepper_init");
  promise(memcmp(now, before, size) == 0, "changed the state", "fb_stepper_init");
  if (again == FB_OK) {
    again = fb_stepper_step(&stepper);
    promise(again == status, "another status than the step itself", "fb_stepper_step");
    promise(memcmp(now, &after, size) == 0, "other bits than the step itself", "fb_stepper_step");
    promise(stepper.t == (status == FB_OK ? way->dt : FB_R(0.0)), "the clock", "fb_stepper_step");
  }
  memcpy(now, &after, size);
}

/* What a callback for distributed loads does: the same at every call, so that steps can be repeated. */
typedef enum trick { DRAG, SPRING, HUGE_LOAD, LOST_NUMBER, LOST_TORQUE, FAILS, NO_STATUS, SPOILS, TRICKS } trick;

static fb_status distributed(fb_line_point *point, int n, fb_real t, void *user)
{
  const trick *const how = user;
  (void)t;
  for (int k = 0; k < n; k++) {
    for (int i = 0; i < 3; i++) {
      point[k].force[i] = *how == DRAG        ? -point[k].length * point[k].velocity[i]
                          : *how == SPRING    ? -point[k].length * point[k].position[i]
                          : *how == HUGE_LOAD ? (fb_real)1e30
                                              : FB_R(0.0);
    }
  }
  switch (*how) {
  case LOST_NUMBER:
    point[n - 1].force[1] = (fb_real)NAN;
    break;
  case LOST_TORQUE:
    point[0].torque[2] = (fb_real)HUGE_VAL;
    break;
  case SPOILS: /* all but loads */
    for (int k = 0; k < n; k++) {
      memset(&point[k], 0xff, offsetof(fb_line_point, force));
    }
    break;
  default:
    break;
  }
  return *how == FAILS ? FB_ERR_CONVERGENCE : *how == NO_STATUS ? (fb_status)77 : FB_OK;
}

/* A beam on a hub, with the effects, base and form that the bytes say; 0: refused. */
static int build_body(bytes *b, int plain, int lines)
{
  static const unsigned effects[] = {FB_EFFECTS_RIGID,
                                     FB_EFFECTS_LINEAR,
                                     FB_EFFECTS_SPIN,
                                     FB_EFFECTS_FULL,
                                     FB_EFFECTS_FULL | FB_EFFECT_DAMPING | FB_EFFECT_GRAVITY,
                                     FB_EFFECTS_STRAIN,
                                     FB_EFFECTS_STRAIN | FB_EFFECT_DAMPING};
  static const fb_real center[3] = {0, 0, 0}, inertia[6] = {1, 2, 3, 0, 0, 0};
  fb_beam_desc desc;
  fb_modes_desc keep;
  fb_body_desc level;
  int node, bits;
  fb_form_desc kind = {FB_FORM_MOMENTUM, FB_TORQUE_IDENTITY, NULL};
  memset(&desc, 0, sizeof desc);
  memset(&keep, 0, sizeof keep);
  memset(&level, 0, sizeof level);
  desc.length = FB_R(2.0);
  desc.n_element = 1 + (take_byte(b) & 1);
  desc.n_station = 1;
  desc.station[0].mass = FB_R(1.0);
  desc.station[0].EA = FB_R(1e5);
  desc.station[0].GJ = FB_R(50.0);
  desc.station[0].EI_y = FB_R(100.0);
  desc.station[0].EI_z = take_byte(b) & 1 ? FB_R(100.0) : FB_R(3e4);
  desc.station[0].i_y = desc.station[0].i_z = FB_R(0.01);
  level.effects = effects[take_below(b, 7)];
  level.effects |= lines ? FB_EFFECTS_LARGE : 0u;
  level.base = (fb_base)take_below(b, FB_BASE_COUNT);
  kind.form = form = plain ? FB_FORM_MOMENTUM : (fb_form)take_below(b, FB_FORM_COUNT);
  level.allow_long_step = take_byte(b) & 1;
  bits = take_byte(b);
  level.zeta[0] = level.zeta[1] = bits & 1 ? FB_R(0.02) : FB_R(1.5);
  if ((bits & 2) && form == FB_FORM_MOMENTUM) {
    level.n_rotor = 2;
    level.rotor[0].axis[0] = level.rotor[1].axis[2] = FB_R(1.0);
    level.rotor[0].inertia = level.rotor[1].inertia = FB_R(0.05);
    level.rotor[0].friction = level.rotor[0].friction_speed = FB_R(0.1);
    level.rotor[0].static_imbalance = bits & 4 ? FB_R(1e-3) : FB_R(0.0);
    level.rotor[1].node = 1;
    level.rotor[1].given = (bits & 8) != 0;
  }
  if ((bits & 16) && !(plain && FB_SINGLE) && form == FB_FORM_MOMENTUM &&
      (level.effects & FB_EFFECT_RESIDUAL_INERTIA)) {
    level.mu = FB_R(20.0);
    level.center[1] = FB_R(5.0);
  }
  level.gravity[2] = take_real(b);
  if (!(level.effects & FB_EFFECT_DAMPING)) {
    level.zeta[0] = level.zeta[1] = FB_R(0.0);
  }
  if (!(level.effects & FB_EFFECT_GRAVITY)) {
    level.gravity[2] = FB_R(0.0);
  }
  if (level.effects & FB_EFFECT_NONLINEAR_STRAIN) {
    desc.n_element = 1;
    keep.basis = FB_BASIS_FUNCTIONS;
    keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = keep.count[FB_KIND_AXIAL] = FB_ALL_MODES;
    keep.root_strain = 1;
  } else {
    keep.count[FB_KIND_BEND_Y] = 1;
    keep.count[FB_KIND_BEND_Z] = take_byte(b) & 1;
    keep.count[FB_KIND_AXIAL] = take_byte(b) & 1;
  }
  if (!(fb_beam_init(&beam, &desc) == FB_OK && fb_modes_solve(&modes, &modes_work, &beam, &keep) == FB_OK &&
        fb_shape_init(&shape, modes.n) == FB_OK &&
        fb_shape_add_rigid(&shape, take_byte(b) & 1 ? FB_R(20.0) : FB_R(0.01), center, inertia) == FB_OK &&
        fb_shape_add_beam(&shape, 0, &beam, &modes) == FB_OK &&
        fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, FB_R(2.0)) == FB_OK &&
        (!(level.effects & FB_EFFECT_NONLINEAR_STRAIN) ||
         fb_shape_add_beam_strain(&shape, 0, &beam, &modes) == FB_OK) &&
        fb_form_init(&formed, &body_work, &shape, &level, &kind) == FB_OK)) {
    return 0;
  }
  body = formed.body;
  return 1;
}

static void take_load(fb_load *load, bytes *b)
{
  load->node = take_byte(b) & 1;
  load->axes = (fb_axes)take_below(b, FB_AXES_COUNT);
  for (int i = 0; i < 3; i++) {
    load->force[i] = take_part(b, 5.0);
    load->torque[i] = take_part(b, 5.0);
  }
}

static fb_real take_step(bytes *b)
{
  const int k = take_byte(b);
  return k < 200 ? (fb_real)(1e-4 * (k + 1)) : take_real(b);
}

static void take_input(fb_input *input, bytes *b)
{
  memset(input, 0, sizeof *input);
  input->n_load = take_byte(b) & 1;
  take_load(&input->load[0], b);
  for (int i = 0; i < 3; i++) {
    input->v[i] = take_part(b, 3.0);
    input->w[i] = take_part(b, 3.0);
    input->v_dot[i] = take_part(b, 3.0);
    input->w_dot[i] = take_part(b, 3.0);
  }
  input->rotor[0].torque = input->v[0];
  input->rotor[1].momentum = body.n_rotor > 0 && body.rotor[1].given ? input->v[1] : FB_R(0.0);
  if (take_byte(b) > 220) {
    spoil(input, sizeof *input, b);
  }
}

static int state_is_finite(const fb_state *s, int n)
{
  return all_finite(s->rho, 3) && all_finite(s->quat, 4) && all_finite(s->u, 3) && all_finite(s->L, 3) &&
         all_finite(s->q, n) && all_finite(s->pi, n);
}

/* One step of an integrator, of one input that is held or of three: its name goes to *name, the step to *way; without
   body if it was not made. */
static fb_status step_body(const char **name, fb_stepper_desc *way, bytes *b, const fb_input *input, int n_input)
{
  const fb_input *const start = input, *const middle = n_input == 3 ? input + 1 : input,
                        *const end = n_input == 3 ? input + 2 : input;
  const fb_real dt = take_step(b);
  const int iterations = take_byte(b) < 250 ? take_byte(b) % 4 : take_whole(b);
  fb_status status;
  memset(way, 0, sizeof *way);
  way->body = &body;
  way->state = &state;
  way->input = input;
  way->n_input = n_input;
  way->integrator = (fb_integrator)take_below(b, FB_INTEGRATOR_COUNT);
  way->exponential = &exponential;
  way->dt = dt;
  way->iterations = iterations;
  if (form != FB_FORM_MOMENTUM) {
    *name = "fb_form_step";
    way->body = NULL;
    return fb_form_step(&formed, &state, &form_work, way->integrator, start, middle, end, dt, iterations);
  }
  switch (way->integrator) {
  case FB_INTEGRATOR_RK4:
    *name = "fb_rk4_step";
    return fb_rk4_step(&body, &state, &rk4_work, start, middle, end, dt);
  case FB_INTEGRATOR_MIDPOINT:
    *name = "fb_midpoint_step";
    return fb_midpoint_step(&body, &state, &implicit_work, middle, dt, iterations);
  case FB_INTEGRATOR_SDIRK:
    *name = "fb_sdirk_step";
    return fb_sdirk_step(&body, &state, &implicit_work, start, end, dt, iterations);
  case FB_INTEGRATOR_EXPONENTIAL:
    *name = "fb_exponential_step";
    status = fb_exponential_init(&exponential, &body_work, &body, dt);
    way->body = status ? NULL : way->body;
    return status ? status : fb_exponential_step(&body, &exponential, &state, &exponential_work, start, middle, end);
  case FB_INTEGRATOR_COUNT:
    break;
  }
  return FB_ERR_UNSUPPORTED;
}

static void lines_look(const fb_motion *motion, const fb_input *input)
{
  fb_line_motion point[FB_MAX_LINE_POINTS];
  int n;
  if (fb_body_lines_eval(&body, point, &n, &state, motion, input) == FB_OK) {
    for (int k = 0; k < n; k++) {
      promise(all_finite(point[k].at.position, 3) && all_finite(point[k].force, 3) && all_finite(point[k].moment, 3),
              "not finite", "fb_body_lines_eval");
    }
  }
}

static void run_body(bytes *b, int lines)
{
  trick how = DRAG;
  if (!build_body(b, 0, lines)) {
    return;
  }
  promise(fb_state_init(&body, &state) == FB_OK, "refused", "fb_state_init");
  for (int k = 0; k < 16 && b->left > 0; k++) {
    fb_input input[3];
    fb_state before;
    fb_motion motion;
    fb_energy energy;
    fb_node_motion node;
    fb_stepper_desc way;
    const char *name;
    fb_status status;
    take_input(&input[0], b);
    input[0].distributed = NULL;
    if (lines) {
      const int byte = take_byte(b);
      how = (trick)(byte % (int)TRICKS);
      input[0].distributed = byte < 128 ? distributed : NULL;
      input[0].user = &how;
    }
    input[1] = input[2] = input[0];
    for (int i = 0; i < body.n; i++) {
      state.q[i] += take_part(b, 0.1);
      state.pi[i] += take_part(b, 1.0);
      if (i < body.n_rotor) {
        state.pi[body.n + i] += state.q[i];
      }
    }
    state.L[take_below(b, 3)] += take_part(b, 30.0);
    if (take_byte(b) > 230) {
      spoil(&state, sizeof state, b);
    }
    before = state;
    status = step_body(&name, &way, b, input, take_byte(b) & 1 ? 1 : 3);
    promise(status == FB_OK || memcmp(&before, &state, sizeof state) == 0, "a failure changed the state", name);
    promise(status != FB_OK || state_is_finite(&state, body.n), "the state is not finite", name);
    promise(status != FB_OK || fb_state_check(&body, &state) == FB_OK, "the state does not pass its check", name);
    if (k % 4 == 0 && way.body) {
      step_again(&way, &state, &before, sizeof state, status, fb_state_check(&body, &before));
    }
    status = fb_form_motion_eval(&formed, &motion, &state, input);
    promise(status != FB_OK ||
                (all_finite(motion.v, 3) && all_finite(motion.w, 3) && all_finite(motion.acceleration, 3) &&
                 all_finite(motion.w_dot, 3) && all_finite(motion.q_ddot, body.n) &&
                 all_finite(motion.reaction_force, 3) && all_finite(motion.reaction_torque, 3)),
            "not finite", "fb_form_motion_eval");
    if (status == FB_OK && fb_body_node_motion_eval(&body, &node, &state, &motion, 1) == FB_OK) {
      promise(all_finite(node.acceleration, 3) && all_finite(node.quat, 4), "not finite", "fb_body_node_motion_eval");
    }
    if (status == FB_OK && lines) {
      lines_look(&motion, input);
    }
    status = fb_form_energy_eval(&formed, &energy, &state, input);
    promise(status != FB_OK || (isfinite(energy.kinetic) && isfinite(energy.strain)), "not finite",
            "fb_form_energy_eval");
    if (fb_state_check(&body, &state) != FB_OK) {
      promise(fb_state_init(&body, &state) == FB_OK, "refused", "fb_state_init");
    }
  }
}

static void take_joint(fb_joint_desc *joint, bytes *b, int below)
{
  joint->kind = (fb_joint_kind)take_below(b, FB_JOINT_COUNT);
  joint->parent = take_below(b, below + 1) - 1;
  joint->parent_node = joint->parent < 0 ? 0 : take_byte(b) & 1;
  joint->position[0] = take_part(b, 1.0);
  joint->attitude[0] = FB_R(1.0);
  joint->attitude[1] = take_part(b, 1.0);
  joint->attitude[2] = take_part(b, 1.0);
  joint->pitch = take_part(b, 0.1);
  for (int i = 0; i < 3 && joint->kind != FB_JOINT_FREE; i++) {
    const int springs = take_byte(b), dampers = take_byte(b), ball = joint->kind == FB_JOINT_SPHERICAL;
    joint->stiffness[i] = springs & 1 ? FB_R(100.0) : FB_R(0.0);
    joint->stop_stiffness[i] = springs & 2 && !ball ? FB_R(300.0) : FB_R(0.0);
    joint->stop[i][0] = FB_R(-0.1);
    joint->stop[i][1] = FB_R(0.2);
    joint->damping[i] = dampers & 1 ? FB_R(1.0) : FB_R(0.0);
    joint->friction[i] = dampers & 2 && !ball ? FB_R(2.0) : FB_R(0.0);
    joint->friction_speed[i] = FB_R(0.1);
    joint->stop_loss[i] = dampers & 4 ? FB_R(0.5) : FB_R(0.0);
    joint->mode[i] = (fb_axis_mode)(take_byte(b) < 200 ? 0 : take_below(b, FB_AXIS_COUNT));
  }
}

static int build_system(bytes *b)
{
  static fb_system_desc desc;
  memset(&desc, 0, sizeof desc);
  desc.n_body = 1 + take_below(b, 3);
  desc.method = (fb_method)take_below(b, FB_METHOD_COUNT);
  desc.allow_long_step = take_byte(b) & 1;
  for (int k = 0; k < desc.n_body; k++) {
    take_joint(&desc.joint[k], b, k);
  }
  desc.n_loop = take_byte(b) > 200;
  take_joint(&desc.loop[0], b, desc.n_body);
  desc.loop[0].child = take_below(b, desc.n_body);
  desc.n_spring = take_byte(b) > 128;
  desc.spring[0].body[0] = take_below(b, desc.n_body + 1) - 1;
  desc.spring[0].body[1] = take_below(b, desc.n_body);
  desc.spring[0].node[1] = take_byte(b) & 1;
  desc.spring[0].stiffness = FB_FABS(take_part(b, 100.0));
  desc.spring[0].damping = FB_FABS(take_part(b, 1.0));
  desc.spring[0].length = FB_FABS(take_part(b, 1.0));
  if (desc.n_loop == 0) {
    memset(&desc.loop[0], 0, sizeof desc.loop[0]);
  }
  if (desc.n_spring == 0) {
    memset(&desc.spring[0], 0, sizeof desc.spring[0]);
  }
  if (take_byte(b) > 240) {
    spoil(&desc, sizeof desc, b);
  }
  return fb_system_init(&links, &system_work, &body, &desc, 1) == FB_OK &&
         fb_system_state_init(&links, &body, &system_state, &system_work, NULL, NULL) == FB_OK;
}

static int system_is_finite(const fb_system_state *s)
{
  int finite = isfinite(s->motor_work) != 0;
  for (int k = 0; k < links.n_body; k++) {
    const fb_link_state *link = &s->link[k];
    finite = finite && all_finite(link->u, 3) && all_finite(link->lost_x, 3) && all_finite(link->lost_u, 3);
    finite = finite && all_finite(link->x, 3) && all_finite(link->quat, 4) && all_finite(link->p, 6) &&
             all_finite(link->q, body.n_coordinate) && all_finite(link->pi, body.n_coordinate);
  }
  return finite;
}

/* A penalty at the load, friction in the first joint. */
static fb_status take_forces(fb_system_forces *now, void *user)
{
  for (int i = 0; i < now->n_point; i++) {
    now->point[i].force[1] =
        now->point[i].position[1] < FB_R(0.0) ? -FB_R(50.0) * now->point[i].position[1] : FB_R(0.0);
    now->point[i].torque[0] = -now->point[i].angular_rate[0];
  }
  now->joint[0].torque[0] = -FB_R(0.1) * now->joint[0].speed[0];
  now->pull[0] = -now->spring[0].rate;
  (void)user;
  return FB_OK;
}

static void take_system_input(fb_system_input *input, bytes *b)
{
  memset(input, 0, sizeof *input);
  input->n_load = take_byte(b) & 1;
  input->load[0].body = take_below(b, links.n_body);
  take_load(&input->load[0].load, b);
  input->pull[0] = take_part(b, 5.0);
  input->forces = take_byte(b) > 200 ? take_forces : NULL;
  for (int j = 0; j < links.n_body; j++) {
    input->drive[j].torque[0] = take_part(b, 5.0);
    input->drive[j].rate[0] = take_part(b, 1.0);
    input->rotor[j][0].torque = input->drive[j].torque[0];
    input->rotor[j][1].momentum = body.n_rotor > 0 && body.rotor[1].given ? input->drive[j].rate[0] : FB_R(0.0);
  }
  if (take_byte(b) > 220) {
    spoil(input, offsetof(fb_system_input, rows), b);
  }
}

static void run_system(bytes *b, int lines)
{
  static fb_system_state before;
  static fb_system_motion motion;
  if (!build_body(b, 1, lines) || !build_system(b)) {
    return;
  }
  for (int k = 0; k < 10 && b->left > 0; k++) {
    static fb_system_input input;
    fb_status status;
    fb_stepper_desc by;
    const int way = take_below(b, 5), link = take_below(b, links.n_body);
    const fb_real dt = take_step(b);
    take_system_input(&input, b);
    system_state.link[link].p[take_below(b, 6)] += take_part(b, 10.0);
    system_state.link[link].q[0] += take_part(b, 0.1);
    if (take_byte(b) > 230) {
      spoil(&system_state, sizeof system_state, b);
    }
    before = system_state;
    memset(&by, 0, sizeof by);
    by.body = &body;
    by.system = &links;
    by.system_state = &system_state;
    by.system_work = &system_work;
    by.system_input = &input;
    by.dt = dt;
    by.integrator = way & 1 ? FB_INTEGRATOR_RK4 : FB_INTEGRATOR_SDIRK;
    if (way == 4) {
      status = fb_system_axis_set(&links, &body, &system_state, &system_work, take_below(b, 4), take_below(b, 3),
                                  (fb_axis_mode)take_below(b, FB_AXIS_COUNT), &input);
    } else if (way & 1) {
      status = fb_system_rk4_step(&links, &body, &system_state, &system_work, &input, &input, &input, dt);
    } else {
      by.iterations = take_byte(b) % 4;
      status = fb_system_sdirk_step(&links, &body, &system_state, &system_work, &input, &input, dt, by.iterations);
    }
    promise(status == FB_OK || memcmp(&before, &system_state, sizeof before) == 0, "a failure changed the state",
            way == 4 ? "fb_system_axis_set" : "a step of a system");
    promise(status != FB_OK || system_is_finite(&system_state), "the state is not finite", "a system");
    promise(status != FB_OK || way == 4 || fb_system_state_check(&links, &body, &system_state) == FB_OK,
            "a step has made what is no state", "a system");
    if (k % 4 == 0 && way != 4) {
      step_again(&by, &system_state, &before, sizeof before, status, fb_system_state_check(&links, &body, &before));
    }
    status = fb_system_motion_eval(&links, &body, &system_work, &motion, &system_state, &input);
    for (int j = 0; j < links.n_body && status == FB_OK; j++) {
      promise(all_finite(motion.motion[j].acceleration, 3) && all_finite(motion.motion[j].q_ddot, body.n) &&
                  all_finite(motion.pose[j].rho, 3) && all_finite(motion.joint[j].force, 3) && isfinite(motion.power),
              "not finite", "fb_system_motion_eval");
    }
    if (status != FB_OK && fb_system_state_init(&links, &body, &system_state, &system_work, NULL, NULL) != FB_OK) {
      return;
    }
  }
}

static int build_exact(bytes *b)
{
  static fb_exact_desc desc;
  fb_section section;
  memset(&desc, 0, sizeof desc);
  memset(&section, 0, sizeof section);
  section.mass = FB_R(1.0);
  section.EA = take_byte(b) & 1 ? FB_R(1e5) : FB_R(0.0);
  section.GJ = FB_R(50.0);
  section.EI_y = section.EI_z = FB_R(100.0);
  section.i_y = section.i_z = FB_R(0.01);
  desc.length = FB_R(2.0);
  desc.n_element = 1 + take_below(b, 4);
  desc.n_station = 1;
  desc.root = take_byte(b) & 1 ? take_below(b, 65) : FB_END_DEFAULT;
  desc.tip = take_byte(b) & 1 ? take_below(b, 65) : FB_END_DEFAULT;
  desc.n_lump = take_byte(b);
  desc.box = desc.n_lump & 2;
  desc.n_lump &= 1;
  if (desc.n_lump > 0) {
    desc.lump[0].node = 1;
    desc.lump[0].mass = FB_R(2.0);
    desc.lump[0].inertia[0] = desc.lump[0].inertia[1] = desc.lump[0].inertia[2] = FB_R(1.0);
  }
  desc.n_joint = take_below(b, 3);
  for (int k = 0; k < desc.n_joint; k++) {
    desc.joint[k].element = take_below(b, 4);
    desc.joint[k].axis[k % 3] = FB_R(1.0);
    desc.joint[k].axis[2] = take_part(b, 1.0);
    desc.joint[k].driven = take_byte(b) > 200;
    desc.joint[k].angle = take_part(b, 4.0);
    desc.joint[k].stiffness = take_byte(b) & 1 ? FB_R(5.0) : FB_R(0.0);
    desc.joint[k].damping = take_byte(b) & 1 ? FB_R(0.2) : FB_R(0.0);
  }
  desc.n_branch = take_below(b, 3);
  for (int k = 0; k < desc.n_branch; k++) {
    desc.branch[k].node = take_below(b, 5);
    desc.branch[k].n_element = 1 + take_below(b, 3);
    desc.branch[k].attitude[0] = take_byte(b) & 1 ? FB_R(1.0) : FB_R(0.0);
    desc.branch[k].attitude[1 + k % 3] = take_part(b, 1.0);
  }
  desc.gravity[2] = take_real(b);
  desc.dissipation = take_byte(b) & 1 ? FB_R(0.3) : FB_R(0.0);
  for (int i = 0; i < 6; i++) {
    desc.damping[i] = take_byte(b) & 1 ? (fb_real)(1 + i) : FB_R(0.0);
  }
  if (fb_exact_station_init(&desc.station[0], &section) != FB_OK) {
    return 0;
  }
  if (take_byte(b) > 220) {
    spoil(&desc, sizeof desc, b);
  }
  return fb_exact_init(&exact, &desc) == FB_OK && fb_exact_state_init(&exact, &exact_state, &exact_work, NULL) == FB_OK;
}

/* A step along the path of steady states under `constant`, from where the path is. */
static fb_status step_path(bytes *b, const fb_exact_input *constant)
{
  static fb_exact_path before;
  static fb_exact_input varied;
  const fb_real arc = take_byte(b) < 200 ? take_part(b, 0.3) : take_real(b);
  fb_status status;
  memset(&varied, 0, sizeof varied);
  varied.n_load = 1;
  take_load(&varied.load[0], b);
  if (take_byte(b) > 220) {
    spoil(&varied, sizeof varied, b);
  }
  if (take_byte(b) > 220) {
    spoil(&path, sizeof path, b);
  }
  before = path;
  status =
      fb_exact_path_step(&exact, &path, &exact_state, &path_work, take_byte(b) < 220 ? constant : NULL, &varied, arc);
  promise(status == FB_OK || memcmp(&before, &path, sizeof before) == 0, "a failure changed the path",
          "fb_exact_path_step");
  promise(status != FB_OK || (all_finite(path.ahead, 6 * (exact.n + 1)) && isfinite(path.factor) &&
                              isfinite(path.rise) && isfinite(path.arc)),
          "the path is not finite", "fb_exact_path_step");
  promise(status != FB_OK || fb_exact_state_check(&exact, &exact_state) == FB_OK, "the state does not pass its check",
          "fb_exact_path_step");
  return status;
}

static void run_exact(bytes *b)
{
  static fb_exact_state before;
  static fb_exact_input input;
  if (!build_exact(b)) {
    return;
  }
  memset(&path, 0, sizeof path);
  for (int k = 0; k < 8 && b->left > 0; k++) {
    fb_exact_node node[FB_MAX_EXACT + 1];
    fb_energy energy;
    const int way = take_byte(b);
    const int steady = way > 200 && k == 0; /* up to 12500 iterations, if it does not converge */
    const int along = way > 150 && !steady;
    const fb_real dt = take_step(b);
    fb_status status;
    memset(&input, 0, sizeof input);
    input.n_load = take_byte(b) & 1;
    take_load(&input.load[0], b);
    input.w[2] = take_part(b, 5.0);
    input.motor[0] = take_part(b, 3.0);
    if (take_byte(b) > 200) {
      spoil(&input, sizeof input, b);
    }
    if (take_byte(b) > 220) {
      spoil(&exact_state, sizeof exact_state, b);
    }
    before = exact_state;
    status = steady  ? fb_exact_trim(&exact, &exact_state, &exact_work, &input)
             : along ? step_path(b, &input)
                     : fb_exact_step(&exact, &exact_state, &exact_work, &input, dt);
    promise(status == FB_OK || memcmp(&before, &exact_state, sizeof before) == 0, "a failure changed the state",
            "the exact beam");
    promise(status != FB_OK ||
                (all_finite(exact_state.r, 3 * (exact.n + 1)) && all_finite(exact_state.quat, 4 * (exact.n + 1)) &&
                 all_finite(exact_state.strain, 6 * exact.n) && all_finite(exact_state.momentum, 6 * exact.n)),
            "the state is not finite", "the exact beam");
    if (k % 4 == 0 && !steady && !along) {
      fb_stepper_desc by;
      memset(&by, 0, sizeof by);
      by.exact = &exact;
      by.exact_state = &exact_state;
      by.exact_work = &exact_work;
      by.exact_input = &input;
      by.dt = dt;
      step_again(&by, &exact_state, &before, sizeof before, status, fb_exact_state_check(&exact, &before));
    }
    if (fb_exact_nodes_eval(&exact, node, &exact_state) == FB_OK) {
      promise(all_finite(node[exact.n].position, 3) && all_finite(node[0].force, 3), "not finite",
              "fb_exact_nodes_eval");
    }
    if (fb_exact_energy_eval(&exact, &energy, &exact_state) == FB_OK) {
      promise(isfinite(energy.kinetic) && isfinite(energy.strain), "not finite", "fb_exact_energy_eval");
    }
    if (fb_exact_state_check(&exact, &exact_state) != FB_OK &&
        fb_exact_state_init(&exact, &exact_state, &exact_work, NULL) != FB_OK) {
      return;
    }
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  bytes b = {data, size};
  const int first = take_byte(&b);
  if (first >= 249 && first < 255) {
    if (first < 252) {
      run_body(&b, 1);
    } else {
      run_system(&b, 1);
    }
    return 0;
  }
  switch (first % 3) {
  case 0:
    run_body(&b, 0);
    break;
  case 1:
    run_system(&b, 0);
    break;
  default:
    run_exact(&b);
  }
  return 0;
}
