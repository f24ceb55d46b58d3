/* system_count - steps one system, for a counter of instructions (tests/checks/instructions.sh).
   usage: system_count CASE INTEGRATOR STEPS
   CASE: rigid, a free body; hinge, a free hub and a rigid arm; links, the same
   with six of them; booms, two bending booms on it; chain, five bending
   bodies, the first of them free; ground, the same, the first one on a hinge; dense, hub and boom by the dense method;
   ring, two arms of a free hub that a loop ties; rows, hub and arm both free, their hinge as a loop. INTEGRATOR: fb_system_rk4_step,
   fb_system_sdirk_step. */
#include "check.h"
#include "random.h"
#include "tree.h"

static fb_body model[2]; /* a rigid one and a bending one */
static fb_system_desc desc;
static fb_system mechanism;
static fb_system_work work;
static fb_system_state state;

static void models(int y, int z)
{
  static const fb_real center[3] = {FB_R(0.5), 0, 0}, inertia[6] = {4, 9, 9}; /* [m], [kg m^2] */
  static fb_shape shape;
  static fb_body_work body_work;
  static fb_beam_desc boom;
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  fb_modes_desc keep;
  fb_body_desc body_desc;
  int tip;
  memset(&body_desc, 0, sizeof body_desc);
  body_desc.base = FB_BASE_PRESCRIBED; /* a slender beam alone has no inertia about its axis */
  fbb_check(fb_shape_init(&shape, 0), "shape");
  fbb_check(fb_shape_add_rigid(&shape, 20, center, inertia), "rigid body");
  body_desc.effects = FB_EFFECTS_RIGID;
  fbb_check(fb_body_init(&model[0], &body_work, &shape, &body_desc), "body");
  memset(&boom, 0, sizeof boom);
  boom.length = 10; /* [m] */
  boom.n_element = 8;
  boom.n_station = 1;
  boom.station[0].mass = 1;                                   /* [kg/m] */
  boom.station[0].EI_y = boom.station[0].EI_z = FB_R(7983.0); /* [N m^2] */
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Y] = y;
  keep.count[FB_KIND_BEND_Z] = z;
  fbb_check(fb_beam_init(&beam, &boom), "beam");
  fbb_check(fb_modes_solve(&modes, &modes_work, &beam, &keep), "modes");
  fbb_check(fb_shape_init(&shape, modes.n), "shape");
  fbb_check(fb_shape_add_rigid(&shape, 20, center, inertia), "root");
  fbb_check(fb_shape_add_beam(&shape, 0, &beam, &modes), "boom");
  fbb_check(fb_shape_add_beam_node(&shape, &tip, 0, &beam, &modes, boom.length), "tip");
  body_desc.effects = FB_EFFECTS_FULL;
  fbb_check(fb_body_init(&model[1], &body_work, &shape, &body_desc), "body");
}

static int build(const char *name)
{
  int tied = strcmp(name, "ring") == 0, chain = strcmp(name, "chain") == 0, ground = strcmp(name, "ground") == 0;
  const fb_joint_kind root = ground ? FB_JOINT_REVOLUTE : FB_JOINT_FREE;
  (void)fbb_hang(&desc, chain || ground ? 1 : 0, root, FB_GROUND, 0);
  desc.method = strcmp(name, "dense") == 0 ? FB_METHOD_DENSE : FB_METHOD_RECURSIVE;
  if (chain || ground) {
    for (int k = 1; k < 5; k++) {
      fbb_turn(fbb_hang(&desc, 1, FB_JOINT_REVOLUTE, k - 1, 1), FB_R(1.5707963267948966), 0, 0);
    }
  } else if (strcmp(name, "hinge") == 0) {
    fbb_hang(&desc, 0, FB_JOINT_REVOLUTE, 0, 0)->position[0] = 1;
  } else if (strcmp(name, "links") == 0) {
    for (int k = 1; k <= 6; k++) {
      fbb_hang(&desc, 0, FB_JOINT_REVOLUTE, k - 1, 0)->position[0] = 1;
    }
  } else if (strcmp(name, "rows") == 0) {
    (void)fbb_hang(&desc, 0, FB_JOINT_FREE, FB_GROUND, 0);
    desc.n_loop = 1;
    desc.loop[0].kind = FB_JOINT_REVOLUTE;
    desc.loop[0].child = 1;
    desc.loop[0].position[0] = 1;
  } else if (strcmp(name, "dense") == 0) {
    fbb_hang(&desc, 1, FB_JOINT_REVOLUTE, 0, 0)->position[0] = 1;
  } else if (strcmp(name, "booms") == 0) {
    fbb_hang(&desc, 1, FB_JOINT_REVOLUTE, 0, 0)->position[0] = 1;
    fbb_turn(fbb_hang(&desc, 1, FB_JOINT_REVOLUTE, 0, 0), 0, 0, FB_R(3.14159265358979324));
    desc.joint[2].position[0] = -FB_R(1.0);
  } else if (tied) { /* the arms' frames meet a meter ahead */
    fbb_hang(&desc, 0, FB_JOINT_REVOLUTE, 0, 0)->position[1] = 1;
    fbb_hang(&desc, 0, FB_JOINT_REVOLUTE, 0, 0)->position[1] = -FB_R(1.0);
    desc.n_loop = 1;
    desc.loop[0].kind = FB_JOINT_SPHERICAL;
    desc.loop[0].parent = 1;
    desc.loop[0].child = 2;
    desc.loop[0].position[0] = desc.loop[0].child_position[0] = 1;
    desc.loop[0].position[1] = -FB_R(1.0);
    desc.loop[0].child_position[1] = 1;
  } else if (strcmp(name, "rigid") != 0) {
    return 0;
  }
  return 1;
}

/* A little off the undeformed state, so that no angle leaves the range in which libm does the same work. */
static void moving(void)
{
  static fb_link_motion motion[FB_MAX_BODIES];
  for (int k = 0; k < desc.n_body; k++) {
    const fb_body *body = &model[desc.model[k]];
    for (int i = 0; i < 6 && !desc.n_loop; i++) {
      motion[k].speed[i] = FB_R(0.2) * fbb_random(50 * k + i);
    }
    for (int i = 0; i < 6 && k == 0; i++) {
      motion[k].speed[i] = FB_R(0.2) * fbb_random(50 * k + i);
    }
    motion[k].value[0] = desc.n_loop ? FB_R(0.0) : FB_R(0.3);
    for (int a = 0; a < body->n; a++) {
      motion[k].q[a] = FB_R(0.05) * body->deflection_limit / body->reach[a] / (fb_real)body->n * fbb_random(50 * k + a);
    }
  }
  fbb_check(fb_system_state_init(&mechanism, model, &state, &work, motion, NULL), "state");
}

int main(int argc, char **argv)
{
  const fb_real dt = FB_R(0.001);
  if (argc != 4 || !build(argv[1])) {
    fprintf(stderr, "usage: system_count CASE INTEGRATOR STEPS\n");
    return 2;
  }
  models(3, 3);
  fbb_check(fb_system_init(&mechanism, &work, model, &desc, fbb_models(&desc)), "system");
  moving();
  for (int k = atoi(argv[3]); k > 0; k--) {
    fbb_check(strcmp(argv[2], "fb_system_sdirk_step") == 0
                  ? fb_system_sdirk_step(&mechanism, model, &state, &work, NULL, NULL, dt, 0)
                  : fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, dt),
              "step");
  }
  printf("p[0] = %g\n", (double)state.link[0].p[0]);
  return 0;
}
