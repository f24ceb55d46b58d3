/* bench_peers_beams - what a second of four scenes of case.h costs, at equal error, by bodies and exact beams of flexbeam and
   by MuJoCo; CSV on stdout. The error is that of `make bench-accuracy`, against the same converged exact beam, whose motion
   is left for other programs in FOLDER/NAME.csv, below the data of the scene (bench/peers.py).
   flexbeam  the whole ladder of ladder.h
   MuJoCo    a chain of rigid links of length h on hinges with springs EI/h, the first half a link from the root, by each of
             its integrators; a base that turns is a hub of 1e9 times the beam's inertia, turned by the torque that takes, given at
             every stage. A ladder ends where steps no longer better the error, or where a run takes longer than 3 s. The least time of
             up to five runs counts.
   bench/peers.sh builds and runs it. Usage: bench_peers_beams FOLDER. Exit: 0, 1 when something is refused. */
#define _POSIX_C_SOURCE 200112L /* clock_gettime, uname */
#define FB_MAX_EXACT 128
#define FB_MAX_MODES 20
#define FLEXBEAM_IMPLEMENTATION
#include "flexbeam.h"

#include "ladder.h"
#include "report.h"
#include "../examples/common/output.h"
#include <mujoco/mujoco.h>
#include <stdarg.h>

#define RUNS 3     /* of each rung, at most */
#define FAR 0.3    /* an error that does not count */
#define SLOW 1e9   /* [ns] a run that takes longer ends its ladder */
#define TURNS 1e9  /* [ns] for the runs of a rung */
#define HEAVY 1e9  /* inertia of a base that turns, by the beam's */
#define TEXT 65536 /* characters of MuJoCo's model */

static const char *const scenes[] = {"spin-up", "slew", "arm", "pendulum"}; /* they bend in the x-y plane */

static void require(int ok, const char *what)
{
  if (!ok) {
    fprintf(stderr, "bench_peers_beams: %s\n", what);
    exit(1);
  }
}

static void print_rung(const fbb_case *c, const char *code, const char *method, double dt, double error,
                       double ns_per_s)
{
  printf("beam,%s,%s,%s,%.4g,%.3e,%.4g\n", c->name, code, method, dt, error, 1e-3 * ns_per_s);
}

/* ---- flexbeam */

static void climb_flexbeam(const fbb_case *c)
{
  double second;
  (void)fbb_climb(&second, c, 0);
  require(fbb_cheapest(FAR) != NULL, "no run of flexbeam counts");
  for (int k = 0; k < fbb_n_entry; k++) {
    const fbb_entry *const e = &fbb_entries[k];
    char method[64];
    if (e->rung == FBB_EXACT) {
      (void)snprintf(method, sizeof method, "%d elements", e->basis.elements);
    } else {
      (void)snprintf(method, sizeof method, "%d modes %s %s", e->basis.y, e->level, e->integrator);
    }
    if (e->error < FAR && !(e->rung == FBB_EXACT && e->basis.elements > 64)) { /* the reference itself */
      print_rung(c, e->rung == FBB_EXACT ? "flexbeam exact" : "flexbeam", method, e->dt, e->error, e->ns_per_s);
    }
  }
}

/* What bench/peers.py reads: data of the scene, then the reference. */
static void write_reference(const fbb_case *c, const char *folder)
{
  char path[512];
  FILE *file;
  (void)snprintf(path, sizeof path, "%s/%s.csv", folder, c->name);
  file = fopen(path, "w");
  require(file != NULL, "cannot write the reference");
  fprintf(
      file,
      "# mass %.17g EI %.17g length %.17g hub_mass %.17g hub_inertia %.17g payload_mass %.17g payload_inertia %.17g "
      "gravity %.17g duration %.17g size %.17g period %.17g\n",
      c->mass, c->EI_z, c->length, c->hub_mass, c->hub_inertia, c->payload_mass, c->payload_inertia, c->gravity[1],
      c->duration, c->size, c->period);
  fprintf(file, "t,x,y\n");
  for (int k = 0; k < FBB_SAMPLES; k++) {
    fprintf(file, "%.17g,%.12g,%.12g\n", (k + 1) * c->duration / FBB_SAMPLES, fbb_reference.out[k][0],
            fbb_reference.out[k][1]);
  }
  require(fclose(file) == 0, "cannot write the reference");
}

/* ---- MuJoCo */

static mjModel *model;
static mjData *data;
static const fbb_case *scene;
static int links, first; /* index of the first spring's angle among the coordinates */
static double base_inertia;

static int is_driven(const fbb_case *c)
{
  return c->base == FB_BASE_PRESCRIBED;
}

/* Called at every stage of a step. The heavy base also takes the gravity of the beam, 1e-9 of its own torque. */
static void drive(const mjModel *m, mjData *d)
{
  fbb_drive at;
  (void)m;
  fbb_drive_at(&at, scene, d->time);
  if (is_driven(scene)) {
    d->qfrc_applied[0] = base_inertia * at.w_dot[2];
  } else if (scene->base == FB_BASE_FREE) {
    d->qfrc_applied[2] = at.torque[2];
  }
}

/* Of steps beyond stability, which are tried; MuJoCo writes them to a file otherwise. */
static void take_warning(const char *text)
{
  (void)text;
}

static char text[TEXT];
static size_t used;

static void add(const char *format, ...)
{
  va_list list;
  va_start(list, format);
  used += (size_t)vsnprintf(text + used, TEXT - used, format, list);
  va_end(list);
  require(used < TEXT - 1, "too many links");
}

static void add_base(const fbb_case *c)
{
  add("<body name=\"base\">");
  if (is_driven(c)) {
    base_inertia = HEAVY * c->mass * c->length * c->length * c->length / 3;
    add("<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/><joint type=\"hinge\" axis=\"0 0 1\" "
        "armature=\"%.17g\"/>\n",
        base_inertia);
  } else if (c->base == FB_BASE_FREE) {
    add("<inertial pos=\"0 0 0\" mass=\"%.17g\" diaginertia=\"%.17g %.17g %.17g\"/><joint type=\"slide\" axis=\"1 0 "
        "0\"/>"
        "<joint type=\"slide\" axis=\"0 1 0\"/><joint type=\"hinge\" axis=\"0 0 1\"/>\n",
        c->hub_mass, c->hub_inertia, c->hub_inertia, c->hub_inertia);
  } else {
    add("<inertial pos=\"0 0 0\" mass=\"1e-9\" diaginertia=\"1e-9 1e-9 1e-9\"/><joint type=\"hinge\" axis=\"0 0 "
        "1\"/>\n");
  }
}

/* A rod of that length from the frame of the body it belongs to, as a body that is welded to it: MuJoCo adds both. */
static void add_rod(const fbb_case *c, double x, double length)
{
  const double mass = c->mass * length, I = mass * length * length / 12;
  add("<body pos=\"%.17g 0 0\"><inertial pos=\"%.17g 0 0\" mass=\"%.17g\" diaginertia=\"%.17g %.17g %.17g\"/>\n", x,
      0.5 * length, mass, 0.01 * I, I, I);
}

/* n links: half a one that is fixed to the base, n - 1 whole ones and half a one. */
static void build_chain(const fbb_case *c, int n, const char *path)
{
  char error[256] = "";
  const double h = c->length / n;
  FILE *file;
  used = 0;
  scene = c;
  links = n;
  first = c->base == FB_BASE_FREE ? 3 : 1;
  add("<mujoco><compiler angle=\"radian\" inertiafromgeom=\"false\" boundmass=\"0\"/><option gravity=\"0 %.17g "
      "0\"/><worldbody>",
      c->gravity[1]);
  add_base(c);
  add_rod(c, 0, 0.5 * h);
  add("</body>");
  for (int i = 0; i < n; i++) {
    add_rod(c, i == 0 ? 0.5 * h : h, i + 1 < n ? h : 0.5 * h);
    add("<joint type=\"hinge\" axis=\"0 0 1\" stiffness=\"%.17g\"/>\n", c->EI_z / h);
  }
  if (c->payload_mass > 0) {
    add("<body pos=\"%.17g 0 0\"><inertial pos=\"0 0 0\" mass=\"%.17g\" diaginertia=\"%.17g %.17g %.17g\"/></body>",
        0.5 * h, c->payload_mass, c->payload_inertia, c->payload_inertia, c->payload_inertia);
  }
  for (int i = 0; i <= n; i++) {
    add("</body>");
  }
  add("</worldbody></mujoco>\n");
  file = fopen(path, "w");
  require(file != NULL && fputs(text, file) >= 0, "cannot write MuJoCo's model");
  require(fclose(file) == 0, "cannot write MuJoCo's model");
  model = mj_loadXML(path, NULL, error, sizeof error);
  require(model != NULL, error);
  model->opt.disableflags |= mjDSBL_CONSTRAINT | mjDSBL_CONTACT;
  data = mj_makeData(model);
  require(data != NULL, "no memory");
}

/* Output as fbb_output: of the tip in the axes of the root, or of the middle against the chord, in its own axes. */
static void look(double out[2], const fbb_case *c)
{
  const double h = c->length / links;
  double turn = 0, x = 0.5 * h, y = 0, middle[3] = {0};
  for (int i = 0; i < links; i++) {
    const double length = i + 1 < links ? h : 0.5 * h;
    turn += data->qpos[first + i];
    if (2 * (i + 1) == links) { /* half a link on */
      middle[0] = x + 0.5 * h * cos(turn);
      middle[1] = y + 0.5 * h * sin(turn);
      middle[2] = turn;
    }
    x += length * cos(turn);
    y += length * sin(turn);
  }
  out[0] = x - c->length;
  out[1] = y;
  if (c->chord) {
    const double dx = middle[0] - 0.5 * x, dy = middle[1] - 0.5 * y, cosine = cos(middle[2]), sine = sin(middle[2]);
    out[0] = dx * cosine + dy * sine;
    out[1] = dy * cosine - dx * sine;
  }
}

/* 1, or 0 when it is beyond stability */
static int run_chain(fbb_history *h, const fbb_case *c, int integrator, int steps)
{
  const double start = clock_own_ns();
  int sound = 1;
  memset(h, 0, sizeof *h);
  model->opt.integrator = integrator;
  model->opt.timestep = c->duration / FBB_SAMPLES / steps;
  mj_resetData(model, data);
  for (int k = 1; k <= FBB_SAMPLES * steps && sound; k++) {
    mj_step(model, data);
    if (k % steps == 0) {
      look(h->out[k / steps - 1], c);
      sound = fabs(h->out[k / steps - 1][1]) < c->length && data->warning[mjWARN_BADQACC].number == 0;
    }
  }
  h->ns_per_s = (clock_own_ns() - start) / c->duration;
  return sound;
}

/* Longest steps first, each two thirds of the one before. */
static void climb_chain(const fbb_case *c, const char *method, int integrator)
{
  static fbb_history h;
  double before = HUGE_VAL, ns = 0;
  for (int steps = 1, stale = 0; stale < 2 && ns < SLOW && steps < 1000000; steps += (steps + 1) / 2) {
    double error, total, least;
    if (!run_chain(&h, c, integrator, steps) || !(fbb_difference(&h, &fbb_reference) < FAR)) {
      continue;
    }
    error = fbb_difference(&h, &fbb_reference);
    total = ns = least = h.ns_per_s * c->duration;
    for (int k = 1; k < RUNS && total < TURNS; k++) {
      require(run_chain(&h, c, integrator, steps), "a run fails the second time");
      least = fmin(least, h.ns_per_s * c->duration);
      total += h.ns_per_s * c->duration;
    }
    print_rung(c, "MuJoCo", method, c->duration / FBB_SAMPLES / steps, error, least / c->duration);
    stale = error > 0.98 * before ? stale + 1 : 0;
    before = fmin(before, error);
  }
}

static void climb_mujoco(const fbb_case *c, const char *path)
{
  static const int counts[] = {4, 8, 12, 16, 24, 42};
  static const struct {
    const char *name;
    int integrator;
  } ways[] = {{"RK4", mjINT_RK4}, {"Euler", mjINT_EULER}};
  mjcb_control = drive;
  mju_user_warning = take_warning;
  for (int count = 0; count < FBB_COUNT(counts); count++) {
    build_chain(c, counts[count], path);
    for (int way = 0; way < FBB_COUNT(ways); way++) {
      char method[48];
      (void)snprintf(method, sizeof method, "%d links %s", counts[count], ways[way].name);
      climb_chain(c, method, ways[way].integrator);
    }
    mj_deleteData(data);
    mj_deleteModel(model);
  }
}

int main(int argc, char **argv)
{
  char path[512];
  output_begin("bench_peers_beams");
  require(argc == 2, "usage: bench_peers_beams FOLDER");
  (void)snprintf(path, sizeof path, "%s/chain.xml", argv[1]);
  (void)fbb_begin();
  printf("# MuJoCo %s; us of processor time per simulated second, the least of up to %d runs\n", mj_versionString(),
         RUNS);
  printf("what,scene,code,method,step,error,time\n");
  for (int s = 0; s < FBB_COUNT(fbb_cases); s++) {
    for (int k = 0; k < FBB_COUNT(scenes); k++) {
      if (strcmp(fbb_cases[s].name, scenes[k]) == 0) {
        fprintf(stderr, "%s\n", scenes[k]);
        climb_flexbeam(&fbb_cases[s]);
        write_reference(&fbb_cases[s], argv[1]);
        climb_mujoco(&fbb_cases[s], path);
        fflush(stdout);
      }
    }
  }
  return 0;
}
