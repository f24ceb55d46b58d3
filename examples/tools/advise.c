/* advise - which effects, how many modes, which integrator and which step a scene calls for, with the configuration to
   compile and the lines of C that follow. The body is one of those flexbeam reduce reads.
   Exit: 0 well, 1 no advice, or what was found misses the tolerance, 2 bad options or input. */
#define _POSIX_C_SOURCE 200809L
#include "capacities.h"
#include "../../flexbeam.h"
#include "model.h"
#define PROGRAM "advise"
#include "config.h"
#include "envelope.h"
#include "../common/advice_out.h"
#include "../common/options.h"
#include "words.h"
#include "../common/output.h"
#include "../common/plot.h"
#include "../common/same_file.h"
#include <time.h>

static const char help[] =
    "advise - effects, modes, integrator and step that a scene calls for\n"
    "usage: flexbeam advise [FILE] [options]\n"
    "  FILE                  description (words: examples/tools/README.md); without it examples/boom.txt is\n"
    "                        spun up to 6 rad/s at 0.63 rad/s^2, above its first frequency\n"
    "  --base B              free, prescribed, pinned or hinged (as the file says)\n"
    "  --modes Y,Z[,A,T]     bending modes along y, z, axial and torsional ones of each beam to choose from (the "
    "file's)\n"
    "the most that happens, body axes; vectors are X,Y,Z, or Z alone:\n"
    "  --spin V              [rad/s] of a prescribed base; of others at the start (0)\n"
    "  --spin-rate R         [rad/s^2] a prescribed base is spun up with, at most; 0: it spins from the start (0)\n"
    "  --acceleration V      [m/s^2] of a prescribed base (0)\n"
    "  --gravity V           [m/s^2], along the axes as they lie at the start (that of the file)\n"
    "  --force NODE,X,Y,Z    [N] at a node of the body, 0: the origin; up to 8 forces and torques\n"
    "  --torque NODE,X,Y,Z   [N m]\n"
    "  --motor ROTOR,TORQUE  [N m] of the motor of a rotor, by its number, 0: the first; all turn as the file says\n"
    "  --frequency F         [Hz] of what drives the modes: forces, torques, acceleration; or steady, or jump\n"
    "                        (steady; jump where the body starts undeformed under gravity or spin)\n"
    "  --duration T          [s] that the answer is wanted for (10)\n"
    "  --frame T             [s] period of a controller, of which the step is a whole part (0: any step)\n"
    "  --node N              whose displacement is wanted (the last)\n"
    "  --tolerance P,P,...   errors allowed, percent of the largest displacement, at most 6 (10,1,0.1)\n"
    "  --json FILE           the advice as named fields, too\n"
    "simulation:\n"
    "  --simulate            looks for the cheapest set by simulating the scene: spin-up, then spin; forces, torques\n"
    "                        and acceleration as a sine, a jump, or steady after a smooth rise\n"
    "  --pulse               a single (1 - cos) of the frequency instead of the sine\n"
    "  --trials N            simulations for a tolerance, at most (2000)\n"
    "  --out NAME            writes NAME.csv and, where gnuplot is there, NAME.svg: reference and what was found\n"
    "  --help                this text\n";

#define TOLERANCES 6

typedef struct options {
  const char *out, *json;
  int base, n_mode, has_gravity, has_frequency, simulate, n_tolerance, n_motor;
  double modes[FB_KIND_COUNT], gravity[3], frame, node, trials, tolerance[TOLERANCES];
  scene scene;
} options;

static fb_advice_work work;

/* ---- options */

static int read_counts(options *o, const char *text)
{
  o->n_mode = read_list(o->modes, FB_KIND_COUNT, text);
  for (int k = 0; k < o->n_mode; k++) {
    if (o->modes[k] < 0 || o->modes[k] > FB_MAX_MODES || o->modes[k] > floor(o->modes[k])) {
      return fail("--modes wants whole numbers from 0 to 24", text);
    }
  }
  return o->n_mode >= 2 ? 0 : fail("--modes wants two to four numbers with commas between", text);
}

static int read_tolerances(options *o, const char *text)
{
  o->n_tolerance = read_list(o->tolerance, TOLERANCES, text);
  for (int k = 0; k < o->n_tolerance; k++) {
    if (o->tolerance[k] < 1e-9 || o->tolerance[k] > 1e4) {
      return fail("--tolerance is 1e-9 to 10000 percent", text);
    }
  }
  return o->n_tolerance > 0 ? 0 : fail("--tolerance wants one to six numbers with commas between", text);
}

static int read_frequency(options *o, const char *text)
{
  double hz = 0;
  const number_option list[] = {{"--frequency", &hz, 1e-9, 1e9}};
  int status = 0;
  o->has_frequency = 1;
  if (strcmp(text, "jump") == 0) {
    o->scene.frequency = HUGE_VAL;
  } else if (strcmp(text, "steady") == 0) {
    o->scene.frequency = 0;
  } else {
    status = read_number(list, 1, "--frequency", text);
    o->scene.frequency = 2 * model_pi * hz;
  }
  return status;
}

static int read_load(scene *s, const char *name, const char *text)
{
  double x[4];
  char message[96];
  fb_load *const load = &s->load[s->n_load];
  if (s->n_load == FB_MAX_LOADS) {
    return fail("too many forces and torques", text);
  }
  if (read_list(x, 4, text) != 4 || x[0] < 0 || x[0] >= FB_MAX_NODES || x[0] > floor(x[0])) {
    snprintf(message, sizeof message, "%s wants a node from 0 to %d and three numbers, with commas between", name,
             FB_MAX_NODES - 1);
    return fail(message, text);
  }
  load->node = (int)x[0];
  load->axes = FB_AXES_BODY;
  for (int i = 0; i < 3; i++) {
    (name[2] == 'f' ? load->force : load->torque)[i] = (fb_real)x[i + 1];
  }
  s->n_load++;
  return 0;
}

static int read_motor(options *o, const char *text)
{
  double x[2];
  if (read_list(x, 2, text) != 2 || x[0] < 0 || x[0] >= FB_MAX_ROTORS || x[0] > floor(x[0])) {
    return fail("--motor wants the number of a rotor and a torque, with a comma between", text);
  }
  o->scene.motor[(int)x[0]] = x[1];
  o->n_motor = o->n_motor > (int)x[0] ? o->n_motor : (int)x[0] + 1;
  return 0;
}

static int read_option(void *to, const char *name, const char *text)
{
  options *const o = (options *)to;
  const number_option list[] = {{"--spin-rate", &o->scene.spin_rate, 0, 1e9},
                                {"--duration", &o->scene.duration, 1e-9, 1e9},
                                {"--frame", &o->frame, 0, 1e9},
                                {"--node", &o->node, 1, FB_MAX_NODES - 1},
                                {"--trials", &o->trials, 2, 1e6}};
  if (strcmp(name, "--base") == 0) {
    return read_choice(&o->base, name, text, "free|prescribed|pinned|hinged");
  }
  if (strcmp(name, "--modes") == 0) {
    return read_counts(o, text);
  }
  if (strcmp(name, "--spin") == 0) {
    return read_vector(o->scene.spin, name, text);
  }
  if (strcmp(name, "--acceleration") == 0) {
    return read_vector(o->scene.acceleration, name, text);
  }
  if (strcmp(name, "--gravity") == 0) {
    o->has_gravity = 1;
    return read_vector(o->gravity, name, text);
  }
  if (strcmp(name, "--force") == 0 || strcmp(name, "--torque") == 0) {
    return read_load(&o->scene, name, text);
  }
  if (strcmp(name, "--motor") == 0) {
    return read_motor(o, text);
  }
  if (strcmp(name, "--frequency") == 0) {
    return read_frequency(o, text);
  }
  if (strcmp(name, "--tolerance") == 0) {
    return read_tolerances(o, text);
  }
  if (strcmp(name, "--json") == 0) {
    o->json = text;
    return 0;
  }
  return strcmp(name, "--out") == 0 ? read_out(&o->out, text)
                                    : read_number(list, (int)(sizeof list / sizeof *list), name, text);
}

static int is_zero(const double x[3])
{
  return !(fabs(x[0]) + fabs(x[1]) + fabs(x[2]) > 0);
}

/* What options say together with the description; 0 or 2 after a message. */
static int check_options(options *o)
{
  scene *const s = &o->scene;
  const int held = s->level.base == FB_BASE_PRESCRIBED, stays = held || s->level.base == FB_BASE_FREE;
  const int pulled = (s->level.effects & FB_EFFECT_GRAVITY) != 0;
  s->node = o->node > 0 ? (int)o->node : model_shape.n_node - 1;
  if (model_shape.n_node < 2 || s->node >= model_shape.n_node) {
    return fail("the description has no such node (a line `node` makes one)", o->node > 0 ? "--node" : "");
  }
  for (int k = 0; k < model.n_part; k++) {
    if (model.part[k].kind == MODEL_COMPONENT && model.part[k].second == 0) {
      return fail(
          "a component wants line, geometric or quadratic lines: without them nobody knows what stiffening would do",
          model.part[k].name[0] ? model.part[k].name : model.name);
    }
  }
  if (model.by_frequency) {
    return fail("parts whose modes are not orthogonal to rounding want one damping ratio here", model.name);
  }
  for (int k = 0; k < s->n_load; k++) {
    if (s->load[k].node >= model_shape.n_node) {
      return fail("the description has no such node", "--force, --torque");
    }
  }
  for (int r = 0; r < o->n_motor; r++) {
    if (r >= model.level.n_rotor || (model.level.rotor[r].given && fabs(s->motor[r]) > 0)) {
      return fail(r < model.level.n_rotor ? "the momentum of this rotor is given: no motor"
                                          : "the description has no such rotor",
                  "--motor");
    }
  }
  if (!held && (s->spin_rate > 0 || !is_zero(s->acceleration))) {
    return fail("--spin-rate and --acceleration are for a prescribed base", "");
  }
  if (held && s->sample * scene_base_steps(s) > SCENE_STEPS) {
    return fail("the base turns or the drive swings too often in this duration to be followed", "--duration");
  }
  if (s->spin_rate > 0 && is_zero(s->spin)) {
    return fail("--spin-rate wants the spin that it leads to", "--spin");
  }
  if (scene_ramp(s) > s->duration) {
    return fail("the duration is too short to reach the spin at this rate", "--spin-rate");
  }
  if (s->pulse && !(s->frequency > 0 && s->frequency < HUGE_VAL)) {
    return fail("--pulse wants a frequency", "");
  }
  if (s->level.base == FB_BASE_HINGED && fabs(s->spin[0]) + fabs(s->spin[1]) > 0) {
    return fail("a hinged body spins about z", "--spin");
  }
  if (!o->has_frequency && !held && (!is_zero(s->spin) || (pulled && !stays))) {
    s->frequency = HUGE_VAL;
  }
  return 0;
}

/* ---- the body */

/* What of the description the options change. */
static int change_model(const options *o)
{
  if (o->base >= 0) {
    model.level.base = (fb_base)o->base;
  }
  if (o->has_gravity) {
    model.level.effects &= ~(unsigned)FB_EFFECT_GRAVITY;
    model.level.effects |= is_zero(o->gravity) ? 0u : (unsigned)FB_EFFECT_GRAVITY;
    for (int i = 0; i < 3; i++) {
      model.level.gravity[i] = (fb_real)o->gravity[i];
    }
  }
  if (o->n_mode > 0 && model.kind == MODEL_COMPONENT) {
    return fail("a component has the modes it has", "--modes");
  }
  for (int p = 0; p < model.n_part && o->n_mode > 0; p++) {
    fb_modes_desc *const modes = &model.part[p].modes;
    modes->lowest = 0;
    modes->mass_fraction = modes->omega_limit = FB_R(0.0);
    for (int k = 0; k < FB_KIND_COUNT; k++) {
      modes->count[k] = k < o->n_mode ? (int)o->modes[k] : 0;
    }
  }
  model.level.effects |= FB_EFFECTS_FULL; /* what is advised is a part of them */
  return 0;
}

static double mode_hz(int a)
{
  return sqrt((double)model_shape.K[a * (model_shape.n + 1)]) / (2 * model_pi);
}

static const char *const kind_name[] = {"bend_y", "bend_z", "axial", "torsion", ""};

/* So many modes of an advice are of that kind and that part (NULL: of any). */
static int count_modes(const fb_advice *a, const model_part *part, int kind)
{
  int n = 0, own;
  for (int k = 0; k < a->n; k++) {
    n += model_mode_kind(a->coordinate[k]) == kind && (!part || model_part_of(a->coordinate[k], &own) == part);
  }
  return n;
}

/* "2 bend_y, 1 bend_z" of the modes of an advice. */
static const char *kinds_text(const fb_advice *a)
{
  static char text[128];
  int used = 0;
  text[0] = 0;
  for (int kind = 0; kind <= FB_KIND_COUNT; kind++) {
    const int n = count_modes(a, NULL, kind);
    if (n > 0) {
      used += snprintf(text + used, sizeof text - (size_t)used, "%s%d %s", used ? ", " : "", n,
                       kind < FB_KIND_COUNT ? kind_name[kind]
                       : n == a->n          ? "modes"
                                            : "imported");
    }
  }
  return text;
}

/* ---- what is printed */

typedef struct named_effect {
  unsigned effect;
  char letter;
  const char *name;
} named_effect;

#define EFFECTS 8
static const named_effect effects[EFFECTS] = {{FB_EFFECT_ELASTIC, 'E', "ELASTIC"},
                                              {FB_EFFECT_SPIN_COUPLING, 'C', "SPIN_COUPLING"},
                                              {FB_EFFECT_RESIDUAL_INERTIA, 'R', "RESIDUAL_INERTIA"},
                                              {FB_EFFECT_SPIN_STIFFENING, 'S', "SPIN_STIFFENING"},
                                              {FB_EFFECT_ACCELERATION_STIFFENING, 'A', "ACCELERATION_STIFFENING"},
                                              {FB_EFFECT_DAMPING, 'D', "DAMPING"},
                                              {FB_EFFECT_GRAVITY, 'G', "GRAVITY"},
                                              {FB_EFFECT_LARGE_DEFLECTION, 'L', "LARGE_DEFLECTION"}};

static const char *letters(unsigned mask)
{
  static char text[EFFECTS + 1];
  int n = 0;
  for (int k = 0; k < EFFECTS; k++) {
    if (mask & effects[k].effect) {
      text[n++] = effects[k].letter;
    }
  }
  text[n] = 0;
  return text;
}

/* Percent of a part, two digits; beyond tenfold: large. */
static const char *percent(fb_real part)
{
  static char text[8][16]; /* for as many calls at a time */
  static int turn = 0;
  const double x = 100 * (double)part;
  char *const at = text[turn = (turn + 1) % 8];
  if (x < 1000) {
    snprintf(at, sizeof text[0], x < 99.5 ? "%.2g" : "%.0f", x);
  } else {
    snprintf(at, sizeof text[0], "large");
  }
  return at;
}

static void print_vector(const char *what, const fb_real x[3], const char *unit)
{
  printf("  %-16s %10.4g %10.4g %10.4g  %s\n", what, (double)x[0], (double)x[1], (double)x[2], unit);
}

static void print_scene(const char *file, const fb_envelope *e)
{
  static const char *const bases[] = {"free", "prescribed", "pinned", "hinged"};
  printf("%s: %s, mass %.6g kg, base %s, %d modes to choose from\n", file, model.name, (double)model_shape.mass,
         bases[model.level.base], model_shape.n);
  printf("the most that happens in %g s, body axes:\n", (double)e->duration);
  print_vector("spin", e->spin, "rad/s");
  print_vector("spin rate", e->spin_rate, "rad/s^2");
  print_vector("acceleration", e->acceleration, "m/s^2, as read by an accelerometer");
  for (int k = 0; k < e->n_load; k++) {
    const fb_load *load = &e->load[k];
    const int force = fabs((double)load->force[0]) + fabs((double)load->force[1]) + fabs((double)load->force[2]) > 0;
    char what[32];
    snprintf(what, sizeof what, "%s, node %d", force ? "force" : "torque", load->node);
    print_vector(what, force ? load->force : load->torque, force ? "N" : "N m");
  }
  for (int r = 0; r < model.level.n_rotor; r++) {
    printf("  rotor %-10s %10.4g  N m s, motor %.4g N m\n", model.rotor[r].text.name, (double)e->rotor[r].momentum,
           (double)e->rotor[r].torque);
  }
  if (e->frequency < FB_HUGE && e->frequency > FB_R(0.0)) {
    printf("  what drives the modes has at most %.4g Hz\n", (double)e->frequency / (2 * model_pi));
  } else {
    printf("  what drives the modes is %s\n", e->frequency > FB_R(0.0) ? "a jump" : "steady");
  }
}

/* One line for each tolerance. */
static void print_table(const options *o, const fb_advice *advice)
{
  printf("output: displacement of node %d, about %.3g m at most\n\n", o->scene.node, (double)advice[0].deflection);
  printf("                                                                       estimated errors [%%]\n");
  printf("tolerance  effects  modes               integrator       step [s] instr/s  effects  modes   step  model    "
         "sum\n");
  for (int k = 0; k < o->n_tolerance; k++) {
    const fb_advice *const a = &advice[k];
    printf("%7g %%  %-7s  %-18s  %-11s %9.3g %7.1e %8s %6s %6s %6s %6s\n", o->tolerance[k], letters(a->effects),
           kinds_text(a), stepper_name[a->integrator], (double)a->dt, (double)a->cost, percent(a->error_effects),
           percent(a->error_modes), percent(a->error_step), percent(a->error_model), percent(a->error));
  }
}

/* What leaving out each effect costs, and which modes there are. */
static void print_parts(const options *o, const fb_advice *advice)
{
  printf("\nletter  effect                    error without it [%%], at least\n");
  for (int k = 0; k < EFFECTS; k++) {
    if (k < FB_ADVICE_EFFECTS) {
      printf("  %c     %-24s  %s\n", effects[k].letter, effects[k].name, percent(advice[0].without[k]));
    } else if (effects[k].effect == FB_EFFECT_LARGE_DEFLECTION) {
      printf("  %c     %-24s  %s\n", effects[k].letter, effects[k].name, percent(advice[0].error_field));
    } else if (advice[0].effects & effects[k].effect) {
      printf("  %c     %-24s  the description's\n", effects[k].letter, effects[k].name);
    }
  }
  printf("\nmode  kind     frequency [Hz]  %sused for\n", model.kind == MODEL_PARTS ? "part         " : "");
  for (int a = 0; a < model_shape.n; a++) {
    int own;
    printf("%4d  %-7s  %14.5g", a, kind_name[model_mode_kind(a)], mode_hz(a));
    if (model.kind == MODEL_PARTS) {
      printf("  %-11s", model_part_of(a, &own)->name);
    }
    for (int k = 0; k < o->n_tolerance; k++) {
      for (int i = 0; i < advice[k].n; i++) {
        if (advice[k].coordinate[i] == a) {
          printf("  %g %%", o->tolerance[k]);
        }
      }
    }
    printf("\n");
  }
}

static int is_kept(const fb_advice *a, int mode)
{
  for (int k = 0; k < a->n; k++) {
    if (a->coordinate[k] == mode) {
      return 1;
    }
  }
  return 0;
}

/* Are the modes kept the lowest of their kinds, so that a description can name them by numbers? Of Ritz modes fewer are
   other ones. */
static int is_lowest(const fb_advice *a, const model_part *part)
{
  for (int mode = part->first; mode < part->first + part->n; mode++) {
    for (int lower = part->first; lower < mode; lower++) {
      if (model_mode_kind(lower) == model_mode_kind(mode) && is_kept(a, mode) && !is_kept(a, lower)) {
        return 0;
      }
    }
  }
  return part->kind == MODEL_BEAM && !(fabs((double)part->modes.spin) > 0);
}

/* The lines of the description that give the advised body. */
static void print_description(const fb_advice *a)
{
  const unsigned own = a->effects & ~(unsigned)(FB_EFFECT_DAMPING | FB_EFFECT_GRAVITY);
  const char *const level = own == FB_EFFECTS_LINEAR ? " linear" : own == FB_EFFECTS_LARGE ? " large" : "";
  for (int p = 0; p < model.n_part; p++) {
    const model_part *const part = &model.part[p];
    if (part->name[0]) {
      printf("  %s %s:%s\n", model_kinds[part->kind], part->name,
             is_lowest(a, part) ? "" : " the modes listed in the lines of C");
    }
    if (is_lowest(a, part)) {
      printf(part->name[0] ? "    modes" : "  modes");
      for (int kind = 0; kind < FB_KIND_COUNT; kind++) {
        const int count = count_modes(a, part, kind);
        if (count > 0) {
          printf(" %s %d", kind_name[kind], count);
        }
      }
      if (a->line_points > 0) {
        printf(" points %d", a->line_points);
      }
      printf("\n");
    }
  }
  printf("  effects%s", level);
  for (int k = 1; k < EFFECTS; k++) {
    if ((level[0] ? a->effects & ~own : a->effects) & effects[k].effect) {
      putchar(' ');
      for (const char *c = effects[k].name; *c; c++) {
        putchar(tolower((unsigned char)*c));
      }
    }
  }
  printf("\n");
}

/* The lines of C that build the body and step it. */
static void print_code(const fb_advice *a, const fb_body *body)
{
  static const char *const bases[] = {"FREE", "PRESCRIBED", "PINNED", "HINGED"};
  static const char *const step[] = {"rk4_step(&body, &state, &work, &start, &middle, &end, dt);",
                                     "midpoint_step(&body, &state, &work, &middle, dt, 0);",
                                     "sdirk_step(&body, &state, &work, &start, &end, dt, 0);",
                                     "exponential_step(&body, &integrator, &state, &work, &start, &middle, &end);"};
  printf("  static const int keep[%d] = {", a->n);
  for (int k = 0; k < a->n; k++) {
    printf("%s%d", k ? ", " : "", a->coordinate[k]);
  }
  printf("};\n  static const fb_real dt = FB_R(%#.9g); // [s]\n", (double)a->dt);
  printf("  static const fb_body_desc level = {.base = FB_BASE_%s,%s\n    .effects = ", bases[body->base],
         a->long_step ? " .allow_long_step = 1," : "");
  for (int k = 0, n = 0; k < EFFECTS; k++) {
    if (a->effects & effects[k].effect) {
      printf("%s%sFB_EFFECT_%s", n ? " |" : "", n == 0 ? "" : n % 3 ? " " : "\n      ", effects[k].name);
      n++;
    }
  }
  printf("};%s\n", body->n_rotor > 0 ? " // and .rotor, .zeta, .gravity as called for"
                   : a->effects & (FB_EFFECT_DAMPING | FB_EFFECT_GRAVITY) ? " // and .zeta, .gravity as called for"
                                                                          : "");
  printf("  status = fb_shape_select(&selected, &shape, keep, %d); // of the %d modes above\n", a->n, model_shape.n);
  printf("  status = status ? status : fb_body_init(&body, &body_work, &selected, &level);\n");
  if (a->integrator == FB_INTEGRATOR_EXPONENTIAL) {
    printf("  status = status ? status : fb_exponential_init(&integrator, &body_work, &body, dt);\n");
  }
  printf("  status = status ? status : fb_%s\n", step[a->integrator]);
}

/* How to build and run the body of an advice, and what it takes. */
static fb_status print_build(const fb_advice *a)
{
  static fb_shape selected;
  static fb_body body;
  static fb_body_work body_work;
  fb_body_desc level = model.level;
  fb_status status = fb_shape_select(&selected, &model_shape, a->coordinate, a->n);
  level.effects = a->effects;
  status = status ? status : fb_body_init(&body, &body_work, &selected, &level);
  if (status != FB_OK) {
    return status;
  }
  printf("lines of the description (flexbeam reduce makes a model in ROM of it):\n");
  print_description(a);
  printf("its configuration, double precision:\n  ");
  config_flags(stdout, &body, 0, "\n ");
  printf("\nlines of C:\n");
  print_code(a, &body);
  return FB_OK;
}

/* Is the reference of simulations one of large deflection? */
static int has_lines(void)
{
  return model_shape.lines_status == FB_OK && model_shape.lines.n_line > 0;
}

/* Can a modal body meet the tolerance? 1 where the advice is worth to be built: as far as estimates tell, or as it was
   simulated. */
static int print_verdict(const fb_advice *a, double tolerance, int simulated)
{
  const double allowed = 0.01 * tolerance;
  printf("\n%g %%: ", tolerance);
  if ((double)a->error_model > allowed && !(simulated && has_lines())) {
    printf("no modal body will do, whatever its modes and effects: it is off by some %s %%.\n"
           "  Take the exact beam: fb_exact (flexbeam exact).\n",
           percent(a->error_model));
    return 0;
  }
  if (!simulated && (double)(a->error_modes + a->error_effects) > allowed) {
    printf("these modes will not do, they are off by some %s %%: give more to choose from (--modes).\n",
           percent(a->error_modes));
    return 0;
  }
  printf("%s, %d of %d modes%s\n", letters(a->effects), a->n, model_shape.n,
         !simulated && (double)a->error > allowed
             ? "; the estimates add up to more than that: look closer by --simulate"
             : "");
  return 1;
}

/* ---- simulation */

typedef struct search {
  const scene *s;
  int count, most;
  double tolerance;
  clock_t said;
  fb_real reference[3 * SCENE_SAMPLES], output[3 * SCENE_SAMPLES];
} search;

/* Runs a candidate; those beyond the number allowed are refused. */
static fb_status run_trial(void *user, fb_real *output, const fb_advice *candidate)
{
  search *const find = (search *)user;
  if (find->count >= find->most) {
    return FB_ERR_CONVERGENCE;
  }
  find->count++;
  if ((double)(clock() - find->said) > 2.0 * CLOCKS_PER_SEC) {
    find->said = clock();
    fprintf(stderr, PROGRAM ": %g %%: %d simulations, now %s, %d modes, %s, step %.3g s\n", find->tolerance,
            find->count, letters(candidate->effects), candidate->n, stepper_name[candidate->integrator],
            (double)candidate->dt);
  }
  return scene_simulate(find->s, output, &model_shape, candidate);
}

/* Largest displacement of the reference [m]. */
static double largest(const search *find)
{
  double size = 0;
  for (int k = 0; k < 3 * find->s->n_sample; k += 3) {
    const fb_real *const r = find->reference + k;
    size = fmax(size, hypot(hypot((double)r[0], (double)r[1]), (double)r[2]));
  }
  return size;
}

/* Largest distance of the output from the reference, by its largest; HUGE_VAL where it is not finite. */
static double distance(const search *find)
{
  const double size = largest(find);
  double most = 0;
  for (int k = 0; k < find->s->n_sample; k++) {
    double d = 0;
    for (int i = 3 * k; i < 3 * k + 3; i++) {
      d = hypot(d, (double)find->output[i] - (double)find->reference[i]);
    }
    if (!isfinite(d)) {
      return HUGE_VAL;
    }
    most = fmax(most, d);
  }
  return size > 0 ? most / size : HUGE_VAL;
}

static void print_trial(const char *what, const fb_advice *a, double error, fb_real estimate)
{
  printf(" %-8s  %-7s  %-18s  %-11s %9.3g %7.1e  %9s  %9s\n", what, letters(a->effects), kinds_text(a),
         stepper_name[a->integrator], (double)a->dt, (double)a->cost, percent((fb_real)fmin(error, 1e9)),
         percent(estimate));
}

static fb_advice found[TOLERANCES];
static fb_real found_output[TOLERANCES][3 * SCENE_SAMPLES];

/* Looks for the cheapest set, runs it again and the advised one beside it; 1 if what was found misses. */
static int simulate_one(search *find, const options *o, const fb_envelope *e, const fb_advice *advised, int k)
{
  const double allowed = 0.01 * o->tolerance[k];
  const fb_trial trial = {run_trial, find, 3 * o->scene.n_sample, 3, find->output, find->reference, 0};
  fb_status status;
  double error;
  find->count = 0;
  find->most = (int)o->trials;
  find->tolerance = o->tolerance[k];
  status = fb_advice_search(&found[k], &work, &model_shape, &model.level, e, (fb_real)allowed, &trial);
  printf("%g %%: %d simulations, displacement of at most %.3g m\n", o->tolerance[k], find->count, largest(find));
  if (find->count < 2) {
    printf(" nothing: the reference: %s\n", refusal_text(status));
    return 1;
  }
  error = scene_simulate(&o->scene, find->output, &model_shape, advised) == FB_OK ? distance(find) : HUGE_VAL;
  print_trial("advised", advised, error, advised->error - (has_lines() ? FB_R(0.0) : advised->error_model));
  if (status != FB_OK) {
    printf(" nothing: %s\n", find->count < find->most ? refusal_text(status) : "no more are allowed (--trials)");
    return 1;
  }
  status = scene_simulate(&o->scene, find->output, &model_shape, &found[k]);
  error = status == FB_OK ? distance(find) : HUGE_VAL;
  memcpy(found_output[k], find->output, sizeof find->output);
  print_trial("found", &found[k], error,
              found[k].error_effects + found[k].error_modes + (has_lines() ? found[k].error_model : FB_R(0.0)));
  if (error > allowed) {
    printf(" what was found MISSES the tolerance when it is run again\n");
  }
  return error > allowed;
}

static int write_csv(const options *o, const search *find, const char *csv)
{
  FILE *out = output_open(csv);
  if (!out) {
    return fail("cannot write", csv);
  }
  fprintf(out, "# time [s], displacement of node %d [m], body axes: x, y, z of the reference", o->scene.node);
  for (int k = 0; k < o->n_tolerance; k++) {
    fprintf(out, ", of the set for %g %%", o->tolerance[k]);
  }
  fputs("\n", out);
  for (int j = 0; j < o->scene.n_sample; j++) {
    fprintf(out, "%.9g", o->scene.sample * (j + 1));
    for (int i = 0; i < 3; i++) {
      fprintf(out, ",%.9g", (double)find->reference[3 * j + i]);
    }
    for (int k = 0; k < o->n_tolerance; k++) {
      for (int i = 0; i < 3; i++) {
        fprintf(out, ",%.9g", (double)found_output[k][3 * j + i]);
      }
    }
    fputs("\n", out);
  }
  if (output_close(out, csv)) {
    return 2;
  }
  printf("table: %s\n", csv);
  return 0;
}

/* The axis along which the output is largest, of the reference and of what was found. */
static void draw(const options *o, const search *find, const char *csv)
{
  static char svg[512], column[TOLERANCES + 1][32], title[TOLERANCES + 1][48], settings[96];
  curve curves[TOLERANCES + 1];
  double most[3] = {0, 0, 0};
  int axis = 0;
  for (int k = 0; k < 3 * o->scene.n_sample; k++) {
    most[k % 3] = fmax(most[k % 3], fabs((double)find->reference[k]));
    axis = most[k % 3] > most[axis] ? k % 3 : axis;
  }
  for (int k = 0; k <= o->n_tolerance; k++) {
    snprintf(column[k], sizeof column[k], "1:%d", 2 + axis + 3 * k);
    snprintf(title[k], sizeof title[k], k ? "found for %g %%" : "reference", k ? o->tolerance[k - 1] : 0.0);
    curves[k].file = csv;
    curves[k].columns = column[k];
    curves[k].style = k ? "with lines dashtype 2 linewidth 2" : "with lines linewidth 2";
    curves[k].title = title[k];
  }
  snprintf(svg, sizeof svg, "%s.svg", o->out);
  snprintf(settings, sizeof settings, "set ylabel 'displacement of node %d along %c [m]'\n", o->scene.node,
           "xyz"[axis]);
  plot(svg, settings, curves, o->n_tolerance + 1, stdout);
}

/* Searches for all tolerances; found[k].n is 0 where there is none. */
static int simulate(const options *o, fb_envelope e, const fb_advice *advised)
{
  static search find;
  static char csv[512];
  int status = 0;
  find.s = &o->scene;
  find.said = clock();
  e.frame = e.frame > FB_R(0.0) ? e.frame : (fb_real)o->scene.sample;
  printf("\nsimulated: errors against all modes and effects in short steps (%s), at\n"
         "%d samples, steps of at most %.3g s; the estimate of what was found leaves out its step\n",
         has_lines() ? "large deflection among them" : "what is called model is not in them", o->scene.n_sample,
         (double)e.frame);
  printf("           effects  modes               integrator       step [s] instr/s  error [%%]  estimated\n");
  for (int k = 0; k < o->n_tolerance; k++) {
    status |= simulate_one(&find, o, &e, &advised[k], k);
  }
  if (o->out) {
    snprintf(csv, sizeof csv, "%s.csv", o->out);
    if (write_csv(o, &find, csv) != 0) {
      return 2;
    }
    draw(o, &find, csv);
  }
  return status;
}

/* What is advised for each tolerance, and what was found by simulation in its place, as fields. */
static int write_fields(const options *o, const char *file, const fb_advice *advice)
{
  FILE *const out = output_open(o->json);
  if (!out) {
    return fail("cannot write", o->json);
  }
  fprintf(out, "{\n  \"format\": \"flexbeam advice 1\",\n  \"flexbeam\": \"%s\",\n  \"body\": ", FB_VERSION);
  linear_quote(out, file, 1);
  fprintf(out, ",\n  \"node\": %d,\n", o->scene.node);
  advice_put_units(out);
  fputs("  \"advice\": [", out);
  for (int k = 0; k < o->n_tolerance; k++) {
    const int simulated = found[k].n > 0;
    fprintf(out, "%s\n    {\"simulated\": %s, ", k ? "," : "", simulated ? "true" : "false");
    advice_put_json(out, simulated ? &found[k] : &advice[k], model_shape.n, 0.01 * o->tolerance[k]);
    fputs("}", out);
  }
  fputs("]\n}\n", out);
  return output_close(out, o->json) ? 2 : 0;
}

/* ---- main */

/* Samples: a whole part of the duration, or whole frames. */
static void set_samples(options *o)
{
  scene *const s = &o->scene;
  const double frames = o->frame > 0 ? fmax(1, floor(s->duration / o->frame + 0.5)) : SCENE_SAMPLES / 2;
  const double each = ceil(frames / SCENE_SAMPLES), frame = o->frame > 0 ? o->frame : s->duration / frames;
  s->sample = each * frame;
  s->n_sample = (int)fmax(1, floor(frames / each));
  s->duration = s->sample * s->n_sample;
}

static int fail_with(const char *file, const char *what, fb_status status)
{
  fprintf(stderr, PROGRAM ": %s: %s: %s\n", file, what, refusal_text(status));
  return 1;
}

/* Files to write that are the description, or each other. */
static int check_files(const options *o, const char *file)
{
  char table[512] = "", picture[512] = "";
  if (o->out) {
    snprintf(table, sizeof table, "%s.csv", o->out);
    snprintf(picture, sizeof picture, "%s.svg", o->out);
  }
  if (same_file(file, table) || same_file(file, picture)) {
    return fail("--out: that is the description itself", file);
  }
  if (!o->json) {
    return 0;
  }
  if (same_file(file, o->json)) {
    return fail("--json: that is the description itself", o->json);
  }
  return strcmp(o->json, table) == 0 || strcmp(o->json, picture) == 0 || same_file(o->json, table) ||
                 same_file(o->json, picture)
             ? fail("--json: that is what --out writes", o->json)
             : 0;
}

/* Envelope and advice; status or FB_OK, *what says at which part. */
static fb_status advise(fb_advice *advice, fb_envelope *e, const options *o, const char **what)
{
  fb_status status = scene_envelope(e, &o->scene, &model_shape);
  *what = "the motion of a rigid body";
  e->frame = (fb_real)o->frame;
  for (int k = 0; k < o->n_tolerance && status == FB_OK; k++) {
    *what = "advice (does anything bend the body?)";
    status = fb_advice_solve(&advice[k], &work, &model_shape, &model.level, e, (fb_real)(0.01 * o->tolerance[k]));
  }
  return status;
}

int advise_main(int argc, char **argv)
{
  static options o;
  static fb_advice advice[TOLERANCES];
  const int named = argc > 1 && argv[1][0] != '-';
  const char *const file = named ? argv[1] : "examples/boom.txt", *what;
  fb_envelope e;
  fb_status status;
  int bad;
  output_begin(PROGRAM);
  o = (options){.base = -1, .trials = 2000, .n_tolerance = 3, .tolerance = {10, 1, 0.1}, .scene = {.duration = 10}};
  if (!named) {
    o.scene.spin[2] = 6;
    o.scene.spin_rate = 0.63;
    o.scene.duration = 30;
  }
  o.simulate = take_flag(&argc, argv, "--simulate");
  o.scene.pulse = take_flag(&argc, argv, "--pulse");
  bad = read_all(argc - named, argv + named, help, read_option, &o);
  if (bad) {
    return bad;
  }
  bad = check_files(&o, file);
  if (bad) {
    return bad;
  }
  if (!model_read(PROGRAM, file)) {
    return 2;
  }
  bad = change_model(&o);
  if (bad) {
    return bad;
  }
  status = model_build(&what);
  if (status != FB_OK) {
    return fail_with(file, what, status);
  }
  o.scene.level = model.level;
  set_samples(&o);
  bad = check_options(&o);
  if (bad) {
    return bad;
  }
  status = advise(advice, &e, &o, &what);
  if (status != FB_OK) {
    return fail_with(file, what, status);
  }
  print_scene(file, &e);
  print_table(&o, advice);
  print_parts(&o, advice);
  bad = o.simulate ? simulate(&o, e, advice) : 0;
  if (o.json && write_fields(&o, file, advice)) {
    return 2;
  }
  for (int k = 0; k < o.n_tolerance && status == FB_OK; k++) {
    const int simulated = found[k].n > 0;
    const fb_advice *const a = simulated ? &found[k] : &advice[k];
    status = print_verdict(a, o.tolerance[k], simulated) ? print_build(a) : FB_OK;
  }
  return status == FB_OK ? bad : fail_with(file, "the advised body", status);
}
