/* reduce - a beam or a finite-element component from a text file becomes one static const body in a C header, for ROM.
   The desktop does the model building; the target includes the header and steps.
   Exit: 0 well, 1 the model cannot be built, 2 bad options or input. */
#define _POSIX_C_SOURCE 200809L /* stat */
#include "capacities.h"
#include "../../flexbeam.h"
#include "model.h"
#include "code_body.h"
#include "rom.h"
#define PROGRAM "reduce"
#include "words.h"
#include "../common/options.h"
#include "../common/output.h"
#include "../common/same_file.h"

static const char help[] =
    "reduce - a body in ROM: from a description of beams and components to a C header\n"
    "usage: flexbeam reduce FILE [options]\n"
    "  --out FILE   where to write the header (standard output)\n"
    "  --single     for single precision (double)\n"
    "  --code       C of the body's own step of rk4, which needs no library, instead (any base, effects up\n"
    "               to full, strain, or large)\n"
    "  --lanes      with --code: also the step of 1, 2, 4 or 8 bodies at once, by vectors of the compiler\n"
    "  --jacobian   C of the body's rates and of a step of rk4 with their exact Jacobians instead, for filters and\n"
    "               controllers that predict (effects up to full)\n"
    "  --loads LIST with --code or --jacobian: a force and a torque at each of these nodes, by names or numbers, are\n"
    "               inputs, too\n"
    "  --sensors LIST  with --jacobian: what an IMU, a star tracker and a receiver see at each of these nodes, too\n"
    "  --vary LIST  with --code: these stay variable, as factors: stiffness,damping,mass,hub_mass,hub_inertia; with\n"
    "               --jacobian stiffness,damping are inputs, so that they can be estimated\n"
    "  --name NAME  of the body (that in the file, or flexible_body)\n"
    "  --help       this text\n"
    "A summary goes to the standard error: mass, frequencies, effective mass, what the model takes.\n"
    "The descriptions are explained in examples/tools/README.md; examples/two_booms.txt and examples/panel.txt are "
    "two.\n";

static void summarize_part(const model_part *part, const fb_modes *modes)
{
  const char *const name = part->name, *const sign = name[0] ? ": " : "";
  if (fabs((double)part->modes.spin) > 0) {
    fprintf(stderr,
            "  %s%s(Ritz modes shaped for the spin: frequencies at rest, the higher ones not those of modes at rest)\n",
            name, sign);
  }
  if (part->kind == MODEL_COMPONENT) {
    double largest = 0;
    for (int a = part->first; a < part->first + part->n; a++) {
      for (int b = part->first; b < a; b++) {
        largest = fmax(largest, fabs((double)model_shape.M[a * model_body.n + b]));
      }
    }
    fprintf(stderr, "  %s%smodes are orthogonal against the nodes' masses to %.2g%s\n", name, sign, largest,
            largest > 1e-3 ? ": masses and shapes do not quite belong together" : "");
  } else {
    fprintf(stderr, "  %s%seffective mass: x %.3f  y %.3f  z %.3f, inertia about the root: x %.3f  y %.3f  z %.3f\n",
            name, sign, (double)modes->effective[0], (double)modes->effective[1], (double)modes->effective[2],
            (double)modes->effective[3], (double)modes->effective[4], (double)modes->effective[5]);
  }
}

static void summarize(const char *file, int steps)
{
  fprintf(stderr, "%s: %s, %d modes, %d nodes, mass %.6g kg\n", file, model.name, model_body.n, model_body.n_node,
          (double)model_body.mass);
  for (int k = 0; k < model_body.n; k++) {
    const double omega = sqrt((double)(model_shape.K[k * (model_body.n + 1)] / model_shape.M[k * (model_body.n + 1)]));
    int own;
    const model_part *const part = model_part_of(k, &own);
    fprintf(stderr, "  mode %2d  %10.5g Hz  damping %.3g\n", k + 1, omega / (2.0 * model_pi),
            model.by_frequency ? model_part_zeta(part, own) : (double)model.level.zeta[k]);
  }
  for (int k = 0; k < model.n_part; k++) {
    summarize_part(&model.part[k], &model_modes[k]);
  }
  for (int k = 0; k < model_body.n_rotor; k++) {
    fprintf(stderr, "  rotor %d  %s: %.6g %s, which the header has not: by %s\n", k, model.rotor[k].text.name,
            model_body.rotor[k].given ? model.rotor[k].momentum : model.rotor[k].text.speed,
            model_body.rotor[k].given ? "N m s" : "rad/s at the start",
            model_body.rotor[k].given ? (steps ? "rotor_motor of the input" : "fb_input.rotor")
            : steps                   ? "rotor_momentum, L and pi of the state"
                                      : "fb_state_rotor_set");
  }
  fprintf(stderr, "  %d terms of Lambda, %d of S\n", model_body.n_lambda, model_body.n_S);
}

/* Of which part a coordinate is, and what. */
static void print_coordinate(FILE *out, int coordinate)
{
  static const char *const kinds[FB_KIND_COUNT + 1] = {"bend_y", "bend_z", "axial", "torsion", "of a component"};
  const int kind = model_mode_kind(coordinate);
  int own;
  const model_part *const part = model_part_of(coordinate, &own);
  fprintf(out, "%s%smode %d, %s", part->name, part->name[0] ? ": " : "", own + 1, kinds[kind]);
}

typedef struct options {
  const char *out, *loads, *sensors;
  code_choice choice;
} options;

static int read_option(void *to, const char *name, const char *text)
{
  options *const o = (options *)to;
  if (strcmp(name, "--out") == 0) {
    return read_out(&o->out, text);
  }
  if (strcmp(name, "--vary") == 0 && o->choice.vary) {
    return fail("--vary takes all names at once, with commas", text);
  }
  if (strcmp(name, "--vary") == 0) {
    o->choice.vary = code_vary_read(text);
    return o->choice.vary ? 0 : fail("--vary wants names out of stiffness,damping,mass,hub_mass,hub_inertia", text);
  }
  if (strcmp(name, "--loads") == 0 || strcmp(name, "--sensors") == 0) {
    const char **const list = name[2] == 'l' ? &o->loads : &o->sensors;
    if (*list) {
      return fail("--loads and --sensors take all nodes at once, with commas", text);
    }
    *list = text;
    return 0;
  }
  if (strcmp(name, "--name") == 0) {
    o->choice.name = text;
    return model_is_name(text) ? 0 : fail("not a C identifier", text);
  }
  return NO_SUCH_OPTION;
}

/* What of the parameters cannot vary, with what would be right; NULL: nothing. */
static const char *vary_refusal(const code_choice *choice)
{
  for (int k = 0; k < model.n_part && choice->vary & (CODE_STIFFNESS | CODE_MASS); k++) {
    const fb_modes_desc *const modes = &model.part[k].modes;
    if (model.part[k].kind == MODEL_BEAM &&
        (fabs((double)modes->spin) > 0 || fabs((double)modes->preload.force) > 0 ||
         fabs((double)modes->preload.acceleration) > 0 || fabs((double)modes->preload.spin) > 0)) {
      return "the shapes of modes under spin or preload depend on stiffness and mass: choose modes at rest";
    }
  }
  return code_vary_refusal(choice, &model_body, model.hub ? model.hub_mass : 0.0);
}

/* Why a node cannot have loads; NULL: it can. text: what it is made of */
static const char *load_refusal(char text[TEXT_MESSAGE], const char *name, int node, int namesakes, int twice)
{
  size_t n;
  if (!name[0]) {
    return "a name is missing; choose names or numbers of nodes, with commas";
  }
  if (node >= 0) {
    return twice           ? "a node is named twice; choose each once"
           : namesakes > 1 ? "several nodes have this name; choose one by its number"
                           : NULL;
  }
  if (model_body.n_node < 2) {
    return "the body has no node but its origin; give it one";
  }
  n = (size_t)snprintf(text, TEXT_MESSAGE, "there is no such node; choose 1 to %d", model_body.n_node - 1);
  for (int k = 1; k < model_body.n_node && n < TEXT_MESSAGE / 2; k++) {
    n += (size_t)snprintf(text + n, TEXT_MESSAGE - n, model.node_name[k][0] ? ", %s" : "%s", model.node_name[k]);
  }
  return text;
}

/* Nodes by names or numbers in a list with commas, of an option; 0: it has been said which is none. */
static int read_nodes(node_set *nodes, const char *option, const char *list, int origin)
{
  for (const char *at = list; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
    char name[TEXT_NAME], text[TEXT_MESSAGE];
    char all[TEXT_MESSAGE + 32];
    const char *what;
    int namesakes = 0, node;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(at, ","), at);
    node = name[0] ? model_find_node(&namesakes, name) : -1;
    what = node == 0 && !origin ? "the load on the origin is an input anyway; leave it out"
                                : load_refusal(text, name, node, namesakes, node >= 0 && node_is_in(nodes, node));
    if (what) {
      snprintf(all, sizeof all, "%s: %s", option, what);
      fail(all, name);
      return 0;
    }
    node_put(nodes, node);
  }
  return 1;
}

/* Says what of the body that is built cannot be written. */
static int is_refused(const char *file, const code_choice *choice)
{
  const char *const what = vary_refusal(choice);
  if (what) {
    fprintf(stderr, "reduce: %s: --vary: %s\n", file, what);
  }
  return what != NULL;
}

/* Writes the step by a trace; 0, or 1: it has been said why not. */
static int write_steps(FILE *out, const options *o, const char *file)
{
  const double *const c = model.hub_center, *const J = model.hub_inertia;
  const double hub[10] = {model.hub_mass, c[0], c[1], c[2], J[0], J[1], J[2], J[3], J[4], J[5]};
  const trace_choice choice = {.name = o->choice.name,
                               .file = file,
                               .single = o->choice.single,
                               .vary = o->choice.vary,
                               .loads = &o->choice.loads,
                               .hub = model.hub && o->choice.vary & CODE_HUB ? hub : NULL};
  const trace_model of = {&model_body, NULL, NULL, sizeof model_body, 0, 0, 1};
  code_choice own = o->choice;
  char text[400];
  int bad;
  own.places = !own.vary ? 0 : own.single ? trace_places_single(&choice, &of) : trace_places(&choice, &of);
  {
    const code w = code_write_body(out, &model_body, &own, file, print_coordinate);
    bad = code_write_steps(&w, choice, &of, own.lanes, code_write_all_types, text);
  }
  if (bad) {
    fprintf(stderr, "reduce: %s: --code: %s\n", file, text);
  }
  return bad;
}

static const char *node_name(int body, int node)
{
  (void)body;
  return model.node_name[node];
}

/* Writes the rates with their Jacobian; 0, or 1: it has been said why not. */
static int write_jacobian(FILE *out, const options *o, const char *file, const node_set *sensors)
{
  const trace_choice choice = {.name = o->choice.name,
                               .file = file,
                               .single = o->choice.single,
                               .vary = o->choice.vary,
                               .loads = &o->choice.loads,
                               .sensors = sensors,
                               .node_name = node_name};
  const trace_model of = {&model_body, NULL, NULL, sizeof model_body, 0, 0, 1};
  char text[400];
  if (trace_write(out, &choice, &of, text) == 0) {
    return 0;
  }
  fprintf(stderr, "reduce: %s: --jacobian: %s\n", file, text);
  return 1;
}

int reduce_main(int argc, char **argv)
{
  const int single = take_flag(&argc, argv, "--single"), steps = take_flag(&argc, argv, "--code");
  const int lanes = take_flag(&argc, argv, "--lanes"), jacobian = take_flag(&argc, argv, "--jacobian");
  const int named = argc > 1 && argv[1][0] != '-';
  const char *const file = named ? argv[1] : "", *what;
  options o = {NULL, NULL, NULL, {NULL, 0, 0, 0, 0, {{0}}}};
  node_set sensors = {{0}};
  FILE *out = stdout;
  fb_status status;
  output_begin(PROGRAM);
  if (read_all(argc - named, argv + named, help, read_option, &o) != 0) {
    return 2;
  }
  if (!named) {
    return fail("a description is missing", "");
  }
  if (lanes && !steps) {
    return fail("--lanes is an option of --code", "");
  }
  if (((o.loads || o.choice.vary) && !steps && !jacobian) || (o.sensors && !jacobian) || (steps && jacobian)) {
    return fail(o.sensors && !jacobian ? "--sensors is an option of --jacobian"
                : steps                ? "--code and --jacobian are two files: choose one"
                : o.loads              ? "--loads is an option of --code and of --jacobian"
                                       : "--vary is an option of --code and of --jacobian",
                "");
  }
  if (jacobian && o.choice.vary & ~(CODE_STIFFNESS | CODE_DAMPING)) {
    return fail("--vary: with --jacobian stiffness and damping alone can vary", "");
  }
  if (!model_read(PROGRAM, file)) {
    return 2;
  }
  if (o.choice.name) {
    strcpy(model.name, o.choice.name);
  }
  o.choice.name = model.name;
  o.choice.single = single;
  o.choice.lanes = lanes;
  if (strncmp(model.name, "fb_", 3) == 0 || strncmp(model.name, "fbi_", 4) == 0 || strncmp(model.name, "FB_", 3) == 0) {
    return fail("names that begin with fb_, fbi_ or FB_ are those of the library: choose another by --name",
                model.name);
  }
  status = model_build(&what);
  if (status != FB_OK) {
    fprintf(stderr, "reduce: %s: %s: %s\n", file, what, refusal_text(status));
    return 1;
  }
  summarize(file, steps);
  if (!read_nodes(&o.choice.loads, "--loads", o.loads, 0) || !read_nodes(&sensors, "--sensors", o.sensors, 1)) {
    return 2;
  }
  if (is_refused(file, &o.choice)) {
    return 1;
  }
  if (o.out && same_file(file, o.out)) {
    fprintf(stderr, "reduce: %s: --out: that is the description itself\n", o.out);
    return 2;
  }
  if (o.out && !(out = output_open(o.out))) {
    fprintf(stderr, "reduce: %s: %s\n", o.out, output_why());
    return 2;
  }
  if (jacobian || steps) {
    if (jacobian ? write_jacobian(out, &o, file, &sensors) : write_steps(out, &o, file)) {
      if (o.out) {
        output_drop(out, o.out);
      }
      return 1;
    }
  } else {
    rom_write(out, &model_body, model.name, file, single);
  }
  return o.out ? output_close(out, o.out) : 0;
}
