/* bench_system - time of one rk4 step of systems of bodies, CSV on stdout:
   chain  1 to 16 flexible bodies, each hinged to the tip of the one before, at right angles to the hinge before; the
          first one to the ground. Recursive and dense method: they take turns, so that they share what disturbs the
          machine.
   42     the spacecraft that NASA's simulator 42 was measured with: a free hub of 1000 kg, appendages of 10 m and
          10 kg on free hinges, as a cantilever 0.5 Hz.
   rotor  three blades of the NREL 5-MW turbine on a hub that turns on its shaft.
   The marks of 42 and of ElastoDyn (OpenFAST) are from other machines; they tell the order of magnitude. Each step
   starts from one of 16 states in turn, so that neither branches nor data are learned; it is timed by itself, and the
   time of an empty measurement is taken off.
   Usage: bench_system [blade table (tests/reference/nrel5mw_blade.csv)] */
#define _POSIX_C_SOURCE 200112L /* clock_gettime, uname */
#define FB_MAX_BODIES 16
#define FB_MAX_MODES 12
#define FB_MAX_SPEEDS 96
#define FLEXBEAM_IMPLEMENTATION
#include "random.h"
#include "report.h"
#include "tree.h"
#include "../examples/common/output.h"
#include <math.h>

#define STATES 16
#define SAMPLES 10000
#define BUDGET 0.4 /* [s] a case takes at most */

enum { METHODS = 2 }; /* recursive, dense */

static const struct {
  const char *name;
  unsigned effects;
} levels[] = {{"spin", FB_EFFECTS_SPIN},
              {"full", FB_EFFECTS_FULL},
              {"full+both", FB_EFFECTS_FULL | FB_EFFECT_DAMPING | FB_EFFECT_GRAVITY},
              {"rigid", FB_EFFECTS_RIGID}};

static fb_body model[2]; /* hub and appendage, or the link of the chain */
static fb_system_desc desc;
static fb_system mechanism[METHODS];
static fb_system_work work;
static fb_system_state start[METHODS][STATES], state;
static double sample[METHODS][SAMPLES];
static double overhead; /* [us] of an empty measurement */

/* ---- models */

static fb_beam_desc beam_desc;
static fb_shape shape;
static fb_body_work body_work;

static void finish(fb_body *body, unsigned effects)
{
  fb_body_desc level;
  memset(&level, 0, sizeof level);
  level.effects = effects;
  level.base = FB_BASE_PRESCRIBED; /* a slender beam alone has no inertia about its axis */
  level.gravity[2] = effects & FB_EFFECT_GRAVITY ? FB_R(-9.81) : FB_R(0.0);
  for (int k = 0; k < FB_MAX_MODES; k++) {
    level.zeta[k] = effects & FB_EFFECT_DAMPING ? FB_R(0.005) : FB_R(0.0);
  }
  fbb_check(fb_body_init(body, &body_work, &shape, &level), "body");
}

static void rigid(fb_body *body, fb_real mass, fb_real x, const fb_real inertia[6])
{
  const fb_real center[3] = {x, 0, 0};
  fbb_check(fb_shape_init(&shape, 0), "shape");
  fbb_check(fb_shape_add_rigid(&shape, mass, center, inertia), "rigid body");
  finish(body, FB_EFFECTS_RIGID);
}

/* The beam of beam_desc with a node at its tip: y and z bending modes, or the lowest of all kinds. */
static void flexible(fb_body *body, int y, int z, int lowest, unsigned effects)
{
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  fb_modes_desc keep;
  int node;
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Y] = y;
  keep.count[FB_KIND_BEND_Z] = z;
  keep.lowest = lowest;
  fbb_check(fb_beam_init(&beam, &beam_desc), "beam");
  fbb_check(fb_modes_solve(&modes, &modes_work, &beam, &keep), "modes");
  fbb_check(fb_shape_init(&shape, modes.n), "shape");
  fbb_check(fb_shape_add_beam(&shape, 0, &beam, &modes), "shape integrals");
  fbb_check(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, beam_desc.length), "tip");
  finish(body, effects);
}

/* 1 kg/m; as a cantilever 0.5 Hz at 10 m: omega = 3.516 sqrt(EI/mass)/L^2. */
static void boom(fb_real length)
{
  memset(&beam_desc, 0, sizeof beam_desc);
  beam_desc.length = length;
  beam_desc.n_element = 8;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = 1;
  beam_desc.station[0].EI_y = beam_desc.station[0].EI_z = FB_R(7983.0);
}

/* The blade table: along x, flap along z, edge along y; mass as ElastoDyn takes it. */
static void blade(const char *name)
{
  char line[512];
  double x, twist, mass, flap, edge, GJ, EA;
  FILE *file = fopen(name, "r");
  memset(&beam_desc, 0, sizeof beam_desc);
  beam_desc.length = FB_R(61.5);
  beam_desc.n_element = 12;
  while (file && fgets(line, (int)sizeof line, file) && beam_desc.n_station < FB_MAX_STATIONS) {
    if (sscanf(line, "%lf,%lf,%lf,%lf,%lf,%lf,%lf", &x, &twist, &mass, &flap, &edge, &GJ, &EA) == 7) {
      fb_section *s = &beam_desc.station[beam_desc.n_station++];
      s->x = (fb_real)(x * 61.5);
      s->twist = (fb_real)(twist * 3.14159265358979324 / 180.0);
      s->mass = (fb_real)(mass * 1.04536);
      s->EI_y = (fb_real)flap;
      s->EI_z = (fb_real)edge;
      s->GJ = (fb_real)GJ;
      s->EA = (fb_real)EA;
    }
  }
  if (!file || ferror(file)) {
    fprintf(stderr, "bench_system: cannot read %s\n", name);
    exit(2);
  }
  fclose(file);
}

/* ---- systems */

static void chain(int n)
{
  memset(&desc, 0, sizeof desc);
  (void)fbb_hang(&desc, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
  for (int k = 1; k < n; k++) {
    fbb_turn(fbb_hang(&desc, 0, FB_JOINT_REVOLUTE, k - 1, 1), FB_R(1.5707963267948966), 0, 0);
  }
}

/* A hub of 1 m half width, one appendage to either side. */
static void spacecraft(int appendages)
{
  memset(&desc, 0, sizeof desc);
  (void)fbb_hang(&desc, 0, FB_JOINT_FREE, FB_GROUND, 0);
  for (int k = 0; k < appendages; k++) {
    fb_joint_desc *joint = fbb_hang(&desc, 1, FB_JOINT_REVOLUTE, 0, 0);
    joint->position[0] = k == 0 ? FB_R(1.0) : -FB_R(1.0);
    fbb_turn(joint, 0, 0, k == 0 ? FB_R(0.0) : FB_R(3.14159265358979324));
  }
}

static void rotor(void)
{
  memset(&desc, 0, sizeof desc);
  (void)fbb_hang(&desc, 0, FB_JOINT_REVOLUTE, FB_GROUND, 0);
  for (int k = 0; k < 3; k++) {
    const fb_real angle = (fb_real)k * FB_R(2.0943951023931955);
    fb_joint_desc *joint = fbb_hang(&desc, 1, FB_JOINT_RIGID, 0, 0);
    joint->position[0] = FB_R(1.5) * FB_COS(angle);
    joint->position[1] = FB_R(1.5) * FB_SIN(angle);
    fbb_turn(joint, 0, 0, angle);
  }
}

/* State number s, each different: turned, moving and deflected by up to some percent of the length. */
static void moving(fb_system_state *out, const fb_system *system, int s)
{
  static fb_link_motion motion[FB_MAX_BODIES];
  memset(motion, 0, sizeof motion);
  for (int k = 0; k < desc.n_body; k++) {
    const fb_body *body = &model[desc.model[k]];
    fb_link_motion *m = &motion[k];
    int next = 1000 * s + 50 * k;
    for (int i = 0; i < 6; i++) {
      m->speed[i] = FB_R(0.3) * fbb_random(next++);
    }
    for (int i = 0; i < 3; i++) {
      m->value[i] = FB_R(0.5) * fbb_random(next++);
    }
    for (int a = 0; a < body->n; a++) {
      m->q[a] = FB_R(0.05) * body->deflection_limit / body->reach[a] / (fb_real)body->n * fbb_random(next++);
    }
  }
  fbb_check(fb_system_state_init(system, model, out, &work, motion, NULL), "state");
}

/* ---- timing */

static fb_real step_length(const fb_system *system)
{
  const fb_real dt = FB_R(0.2) / FB_SQRT(system->limit_elastic + FB_R(1.0));
  return dt < FB_R(0.01) ? dt : FB_R(0.01);
}

static double step_time(int method, int k)
{
  double begin, end;
  state = start[method][k % STATES];
  begin = 1e-3 * clock_ns();
  fbb_check(
      fb_system_rk4_step(&mechanism[method], model, &state, &work, NULL, NULL, NULL, step_length(&mechanism[method])),
      "step");
  end = 1e-3 * clock_ns();
  return end - begin - overhead;
}

/* The methods take turns by 64 steps, so that each finds its own data in the cache. */
static void measure(clock_timing *out, int methods)
{
  const double begin = 1e-3 * clock_ns();
  int n = 0;
  for (int method = 0; method < methods; method++) {
    desc.method = (fb_method)method;
    fbb_check(fb_system_init(&mechanism[method], &work, model, &desc, fbb_models(&desc)), "system");
    for (int s = 0; s < STATES; s++) {
      moving(&start[method][s], &mechanism[method], s);
    }
  }
  while (n + 64 <= SAMPLES && (n < 256 || 1e-3 * clock_ns() - begin < 1e6 * BUDGET * methods)) {
    for (int method = 0; method < methods; method++) {
      for (int k = -8; k < 64; k++) { /* the first ones bring the data in */
        const double us = step_time(method, n + k + STATES);
        if (k >= 0) {
          sample[method][n + k] = us;
        }
      }
    }
    n += 64;
  }
  for (int method = 0; method < methods; method++) {
    out[method] = clock_timing_of(sample[method], n);
  }
}

static void print(const char *scene, int level, const char *method, const clock_timing *t)
{
  int n = 0;
  for (int k = 0; k < desc.n_body; k++) {
    n += model[desc.model[k]].n;
  }
  printf("%s,%d,%d,%s,%s,%.3f,%.3f,%.3f,%.3f", scene, desc.n_body, n, levels[level].name, method, t->lowest, t->median,
         t->p99, t->highest);
}

static void chains(void)
{
  static const int size[] = {1, 2, 4, 6, 8, 16};
  boom(10);
  for (int level = 0; level < 2; level++) {
    double last[17][METHODS];
    memset(last, 0, sizeof last);
    flexible(&model[0], 2, 2, 0, levels[level].effects);
    model[1] = model[0];
    for (int k = 0; k < 6; k++) {
      const int n = size[k];
      clock_timing t[METHODS];
      chain(n);
      measure(t, METHODS);
      for (int method = 0; method < METHODS; method++) {
        last[n][method] = t[method].median;
        print("chain", level, method ? "dense" : "recursive", &t[method]);
        printf(n > 1 && n != 6 ? ",%.2f" : ",", last[n][method] / fmax(last[n / 2][method], 1e-9));
        printf(method ? ",%.2f,,\n" : ",,,\n", t[1].median / t[0].median);
      }
    }
  }
}

static void marked(const char *scene, int level, double mark)
{
  clock_timing t;
  measure(&t, 1);
  print(scene, level, "recursive", &t);
  printf(",,,%.1f,%.2f\n", mark, mark / t.median);
}

static void spacecrafts(void)
{
  static const fb_real hub[6] = {667, 667, 667, 0, 0, 0}, rod[6] = {FB_R(0.1), FB_R(83.3), FB_R(83.3), 0, 0, 0};
  static const struct {
    int appendages, modes; /* of each: half of them along y, half along z */
    double mark;
  } scene[] = {{1, 4, 10.7}, {1, 8, 18.8}, {2, 4, 24.5}, {2, 8, 52.2}};
  rigid(&model[0], 1000, 0, hub);
  rigid(&model[1], 10, 5, rod);
  spacecraft(1);
  marked("hub+rigid", 3, 4.3);
  boom(10);
  for (int k = 0; k < 4; k++) {
    for (int level = 0; level < 2; level++) {
      flexible(&model[1], scene[k].modes / 2, scene[k].modes / 2, 0, levels[level].effects);
      spacecraft(scene[k].appendages);
      marked(scene[k].appendages == 1 ? "hub+boom" : "hub+2 booms", level, scene[k].mark);
    }
  }
}

static void turbine(const char *table)
{
  static const fb_real hub[6] = {FB_R(58000.0), FB_R(58000.0), FB_R(115926.0), 0, 0, 0};
  rigid(&model[0], 56780, 0, hub);
  blade(table);
  for (int level = 0; level < 3; level++) {
    flexible(&model[1], 0, 0, 3, levels[level].effects); /* the lowest: flap, edge, flap */
    rotor();
    marked("rotor", level, 618.0);
  }
}

int main(int argc, char **argv)
{
  output_begin("bench_system");
  overhead = 1e-3 * fbb_begin();
  printf("# us per step of rk4 (%.3f us of the clock taken off), up to %d samples, %d states in turn\n", overhead,
         SAMPLES, STATES);
  printf("# doubled: median to that of half as many bodies; dense/recursive: of the medians\n");
  printf("# mark [us]: NASA 42 on a Xeon core of 2.1 GHz, -O2, dynamics alone; rotor: ElastoDyn. Other machines\n");
  printf("case,bodies,modes,effects,method,min,median,p99,max,doubled,dense/recursive,mark,mark/median\n");
  chains();
  spacecrafts();
  turbine(argc > 1 ? argv[1] : "tests/reference/nrel5mw_blade.csv");
  return 0;
}
