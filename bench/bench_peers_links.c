/* bench_peers_links - ten rigid links on hinges (peers_links.h) by flexbeam and MuJoCo, CSV on stdout; the angles at the end,
   by the shortest step of flexbeam, for the others in FOLDER/links.csv. Error: the largest of those angles [rad]. bench/peers.sh
   builds and runs it. Usage: bench_peers_links FOLDER. Exit: 0, 1 when something is refused. */
#define _POSIX_C_SOURCE 200112L /* clock_gettime, uname */
#define FB_MAX_BODIES 16
#define FB_MAX_SPEEDS 16
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"

#include "report.h"
#include "peers_links.h"
#include "../examples/common/output.h"
#include <mujoco/mujoco.h>
#include <stdlib.h>

#define STEPS ((int)(sizeof link_steps / sizeof link_steps[0]))
#define RUNS 5

typedef void run(double angle[LINKS], double dt);

static void require(int ok, const char *what)
{
  if (!ok) {
    fprintf(stderr, "bench_peers_links: %s\n", what);
    exit(1);
  }
}

/* ---- flexbeam */

static fb_body model[1];
static fb_system mechanism;
static fb_system_work work;

static void build(void)
{
  static const fb_real center[3] = {FB_R(LINK_CENTER), 0, 0}, inertia[6] = {LINK_INERTIA};
  static fb_shape shape;
  static fb_body_work body_work;
  static fb_system_desc desc;
  fb_body_desc body_desc;
  memset(&body_desc, 0, sizeof body_desc);
  body_desc.base = FB_BASE_PRESCRIBED;
  body_desc.effects = FB_EFFECTS_RIGID | FB_EFFECT_GRAVITY;
  body_desc.gravity[2] = FB_R(LINK_GRAVITY);
  fbb_check(fb_shape_init(&shape, 0), "shape");
  fbb_check(fb_shape_add_rigid(&shape, FB_R(LINK_MASS), center, inertia), "link");
  fbb_check(fb_body_init(&model[0], &body_work, &shape, &body_desc), "body");
  for (int k = 0; k < LINKS; k++) {
    fb_joint_desc *const joint = &desc.joint[desc.n_body++];
    joint->kind = FB_JOINT_REVOLUTE;
    joint->parent = k > 0 ? k - 1 : FB_GROUND;
    joint->position[0] = k > 0 ? FB_R(LINK_LENGTH) : FB_R(0.0);
    joint->axis[k % 2 ? 2 : 1] = 1;
  }
  fbb_check(fb_system_init(&mechanism, &work, model, &desc, 1), "system");
}

static void run_flexbeam(double angle[LINKS], double dt)
{
  static fb_link_motion motion[FB_MAX_BODIES];
  static fb_system_state state;
  const int n = (int)(LINK_END / dt + 0.5);
  for (int k = 0; k < LINKS; k++) {
    motion[k].value[0] = FB_R(LINK_ANGLE);
  }
  fbb_check(fb_system_state_init(&mechanism, model, &state, &work, motion, NULL), "state");
  for (int k = 0; k < n; k++) {
    fbb_check(fb_system_rk4_step(&mechanism, model, &state, &work, NULL, NULL, NULL, (fb_real)dt), "step");
  }
  for (int k = 0; k < LINKS; k++) {
    angle[k] = (double)state.link[k].x[0];
  }
}

/* ---- MuJoCo */

static mjModel *chain;
static mjData *data;

static void build_chain(const char *path)
{
  static const double inertia[3] = {LINK_INERTIA};
  char error[256] = "";
  FILE *file = fopen(path, "w");
  require(file != NULL, "cannot write MuJoCo's model");
  fprintf(file, "<mujoco><compiler angle=\"radian\"/><option gravity=\"0 0 %.17g\"/><worldbody>", LINK_GRAVITY);
  for (int k = 0; k < LINKS; k++) {
    fprintf(file,
            "<body pos=\"%.17g 0 0\"><inertial pos=\"%.17g 0 0\" mass=\"%.17g\" diaginertia=\"%.17g %.17g %.17g\"/>"
            "<joint type=\"hinge\" axis=\"%s\"/>\n",
            k > 0 ? LINK_LENGTH : 0.0, LINK_CENTER, LINK_MASS, inertia[0], inertia[1], inertia[2],
            k % 2 ? "0 0 1" : "0 1 0");
  }
  for (int k = 0; k < LINKS; k++) {
    fputs("</body>", file);
  }
  fputs("</worldbody></mujoco>\n", file);
  require(fclose(file) == 0, "cannot write MuJoCo's model");
  chain = mj_loadXML(path, NULL, error, sizeof error);
  require(chain != NULL, error);
  chain->opt.disableflags |= mjDSBL_CONSTRAINT | mjDSBL_CONTACT;
  chain->opt.integrator = mjINT_RK4;
  data = mj_makeData(chain);
  require(data != NULL, "no memory");
}

static void run_chain(double angle[LINKS], double dt)
{
  const int n = (int)(LINK_END / dt + 0.5);
  mj_resetData(chain, data);
  chain->opt.timestep = dt;
  for (int k = 0; k < LINKS; k++) {
    data->qpos[k] = LINK_ANGLE;
  }
  for (int k = 0; k < n; k++) {
    mj_step(chain, data);
  }
  memcpy(angle, data->qpos, LINKS * sizeof angle[0]);
}

/* ---- results */

static void climb(const char *code, run *go, const double reference[LINKS])
{
  for (int s = 0; s < STEPS; s++) {
    double angle[LINKS], error = 0, least = HUGE_VAL;
    for (int k = 0; k < RUNS; k++) {
      const double start = clock_own_ns();
      go(angle, link_steps[s]);
      least = fmin(least, clock_own_ns() - start);
    }
    for (int k = 0; k < LINKS; k++) {
      error = fmax(error, fabs(angle[k] - reference[k]));
    }
    printf("links,,%s,rk4,%.4g,%.3e,%.4g\n", code, link_steps[s], error, 1e-3 * least / LINK_END);
  }
}

int main(int argc, char **argv)
{
  double reference[LINKS];
  char path[512];
  FILE *file;
  output_begin("bench_peers_links");
  require(argc == 2, "usage: bench_peers_links FOLDER");
  (void)fbb_begin();
  build();
  run_flexbeam(reference, link_steps[STEPS - 1] / 2);
  (void)snprintf(path, sizeof path, "%s/links.csv", argv[1]);
  file = fopen(path, "w");
  require(file != NULL, "cannot write the angles");
  for (int k = 0; k < LINKS; k++) {
    fprintf(file, "%.15g\n", reference[k]);
  }
  require(fclose(file) == 0, "cannot write the angles");
  (void)snprintf(path, sizeof path, "%s/links.xml", argv[1]);
  build_chain(path);
  climb("flexbeam", run_flexbeam, reference);
  climb("MuJoCo", run_chain, reference);
  return 0;
}
