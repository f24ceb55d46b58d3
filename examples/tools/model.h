/* model.h - text descriptions of a body, read into a fb_body. README.md lists the words.
   Include flexbeam.h first. Everything is static: one model at a time. */
#ifndef MODEL_H
#define MODEL_H
#include "../common/refusal.h"
#include "../common/text.h"

#define MODEL_NODES 4096 /* of a finite-element component */

typedef enum model_kind { MODEL_BEAM, MODEL_COMPONENT, MODEL_RIGID } model_kind;
static const char *const model_kinds[] = {"beam", "component", "rigid", NULL};

typedef struct model_node {
  int id, marked;
  char name[TEXT_NAME];
  double x[3], mass, inertia[6];
  double shape[6 * FB_MAX_MODES]; /* displacement and rotation by mode */
  int have[FB_MAX_MODES];
} model_node;

static struct model {
  char name[64];
  model_kind kind; /* a beam, nodes and shapes of a finite-element program, or a rigid body: its hub */
  double hub_mass, hub_center[3], hub_inertia[6];
  fb_beam_desc beam;
  fb_modes_desc modes;
  fb_body_desc level;
  int is_fraction[FB_MAX_STATIONS]; /* x of a station is to be multiplied by the length */
  int hub, has_elements, has_modes, n_damping, n_mark;
  text_words seen;
  double mark[FB_MAX_NODES], place[FB_MAX_NODES][3]; /* nodes of a beam, of a rigid body */
  char node_name[FB_MAX_NODES][TEXT_NAME];           /* of all nodes, once built; empty: none */
  int n_mode, n_node, n_pair;
  double frequency[FB_MAX_MODES];
  model_node node[MODEL_NODES];
  struct {
    int a, b;
    double p[3], h[3], gamma[9];
  } pair[FB_MAX_MODES * (FB_MAX_MODES + 1) / 2];
} model;

static fb_beam model_beam;
static fb_modes model_modes;
static fb_modes_work model_modes_work;
static fb_shape model_shape;
static fb_body model_body;
static fb_body_work model_body_work;

static const double model_pi = 3.14159265358979324;

/* The complaint that follows is about the line of that word, if it was there. */
static void model_at(text_file *t, const char *word)
{
  const int line = text_seen(&model.seen, word);
  t->line = line > 0 ? line : t->line;
}

/* Inertia: xx yy zz, and xy xz yz if the line goes on; about the mass center that is at hand. */
static void model_inertia(text_file *t, double inertia[6])
{
  const fb_real center[3] = {0};
  fb_real own[6];
  text_vector(t, "inertia xx yy zz", inertia, 3);
  memset(inertia + 3, 0, 3 * sizeof *inertia);
  if (text_more(t)) {
    text_vector(t, "inertia xy xz yz", inertia + 3, 3);
  }
  for (int i = 0; i < 6; i++) {
    own[i] = (fb_real)inertia[i];
  }
  if (!t->failed && fb_shape_add_rigid(&model_shape, FB_R(0.0), center, own) != FB_OK) { /* built afresh later */
    text_fail(t, "no body has this inertia: each principal one is at most the sum of the other two");
  }
}

static void model_effects(text_file *t)
{
  static const char *const name[] = {"rigid",
                                     "linear",
                                     "spin",
                                     "full",
                                     "large",
                                     "spin_coupling",
                                     "residual_inertia",
                                     "spin_stiffening",
                                     "acceleration_stiffening",
                                     "damping",
                                     "gravity",
                                     "strain",
                                     "large_deflection",
                                     NULL};
  static const unsigned mask[] = {FB_EFFECTS_RIGID,
                                  FB_EFFECTS_LINEAR,
                                  FB_EFFECTS_SPIN,
                                  FB_EFFECTS_FULL,
                                  FB_EFFECTS_LARGE,
                                  FB_EFFECT_ELASTIC | FB_EFFECT_SPIN_COUPLING,
                                  FB_EFFECT_ELASTIC | FB_EFFECT_RESIDUAL_INERTIA,
                                  FB_EFFECT_ELASTIC | FB_EFFECT_SPIN_STIFFENING,
                                  FB_EFFECT_ELASTIC | FB_EFFECT_ACCELERATION_STIFFENING,
                                  FB_EFFECT_DAMPING,
                                  FB_EFFECT_GRAVITY,
                                  FB_EFFECTS_STRAIN,
                                  FB_EFFECT_ELASTIC | FB_EFFECT_LARGE_DEFLECTION};
  model.level.effects = 0;
  do {
    model.level.effects |= mask[text_choice(t, "an effect", name)];
  } while (text_more(t));
}

/* Can a body have this name? */
static int model_is_name(const char *name)
{
  static const char *const keyword[] = {
      "auto",     "break",  "case",     "char",   "const",  "continue", "default", "do",     "double",   "else",
      "enum",     "extern", "float",    "for",    "goto",   "if",       "inline",  "int",    "long",     "register",
      "restrict", "return", "short",    "signed", "sizeof", "static",   "struct",  "switch", "typedef",  "union",
      "unsigned", "void",   "volatile", "while",  "class",  "new",      "delete",  "this",   "template", "namespace"};
  for (int k = 0; k < (int)(sizeof keyword / sizeof *keyword); k++) {
    if (strcmp(name, keyword[k]) == 0) {
      return 0;
    }
  }
  return strlen(name) < sizeof model.name && (isalpha((unsigned char)name[0]) || name[0] == '_') &&
         !name[strspn(name, TEXT_NAME_CHARACTERS)];
}

/* Words that every model may have; 0 if word is none of them. */
static int model_common(text_file *t, const char *word)
{
  static const char *const bases[] = {"free", "prescribed", "pinned", "hinged", NULL};
  if (strcmp(word, "name") == 0) {
    const char *name = text_word(t);
    if (!name || !model_is_name(name)) {
      text_fail(t, "name wants a C identifier of at most %d characters", (int)sizeof model.name - 1);
    } else {
      strcpy(model.name, name);
    }
  } else if (strcmp(word, "hub") == 0) {
    model.hub = 1;
    model.hub_mass = text_number(t, "hub mass");
    if (model.hub_mass < 0) {
      text_fail(t, "the mass of the hub is negative");
    }
    text_vector(t, "hub mass center", model.hub_center, 3);
    model_inertia(t, model.hub_inertia);
  } else if (strcmp(word, "base") == 0) {
    model.level.base = (fb_base)text_choice(t, "base", bases);
  } else if (strcmp(word, "effects") == 0) {
    model_effects(t);
  } else if (strcmp(word, "gravity") == 0) {
    text_reals(t, "gravity", model.level.gravity, 3);
  } else if (strcmp(word, "central_gravity") == 0) {
    model.level.mu = (fb_real)text_number(t, "mu [m^3/s^2]");
    if (!(model.level.mu > FB_R(0.0))) {
      text_fail(t, "central_gravity wants mu above 0, then its center x y z");
    }
    text_reals(t, "the center", model.level.center, 3);
  } else if (strcmp(word, "deflection_limit") == 0) {
    model.level.deflection_limit = (fb_real)text_number(t, "deflection_limit");
  } else if (strcmp(word, "damping") == 0) {
    int n = 0;
    do {
      if (n == FB_MAX_MODES) {
        text_fail(t, "more than %d damping ratios", FB_MAX_MODES);
        break;
      }
      model.level.zeta[n++] = (fb_real)text_number(t, "damping ratio");
      if (model.level.zeta[n - 1] < FB_R(0.0)) {
        text_fail(t, "a damping ratio is negative");
      }
    } while (text_more(t));
    model.n_damping = n;
    for (int k = 1; k < FB_MAX_MODES && n == 1; k++) { /* one for all */
      model.level.zeta[k] = model.level.zeta[0];
    }
  } else {
    return 0;
  }
  text_end_of_line(t);
  return 1;
}

/* What a section must obey, with the line it stands on. */
static void model_section_check(text_file *t, const fb_section *s)
{
  const fb_section *first = &model.beam.station[0];
  const fb_real positive[] = {s->mass, s->EA, s->GJ, s->EI_y, s->EI_z, s->i_y, s->i_z, s->GA_y, s->GA_z};
  static const char *const name[] = {"mass", "EA", "GJ", "EI_y", "EI_z", "i_y", "i_z", "GA_y", "GA_z"};
  for (int k = 0; k < 9; k++) {
    if (positive[k] < FB_R(0.0)) {
      text_fail(t, "%s is negative", name[k]);
    }
  }
  if ((s->GA_y > FB_R(0.0)) != (s->GA_z > FB_R(0.0)) ||
      (model.beam.n_station > 0 && (s->GA_y > FB_R(0.0)) != (first->GA_y > FB_R(0.0)))) {
    text_fail(t, "GA_y and GA_z are both positive at every station, or nowhere");
  }
  if (!(s->GA_y > FB_R(0.0)) && fabs((double)s->shear_y) + fabs((double)s->shear_z) > 0) {
    text_fail(t, "a shear center off the line wants GA_y and GA_z");
  }
  if (fabs((double)s->twist) > 0 && (s->EI_y > FB_R(0.0)) != (s->EI_z > FB_R(0.0))) {
    text_fail(t, "a twisted section wants both EI_y and EI_z");
  }
}

/* Rows of stations up to `end`; the columns are named on the line that opens the table. */
static void model_stations(text_file *t)
{
  static const char *const name[] = {"x",         "fraction",  "mass",    "EA",      "GJ",        "EI_y",   "EI_z",
                                     "i_y",       "i_z",       "GA_y",    "GA_z",    "twist",     "mass_y", "mass_z",
                                     "tension_y", "tension_z", "shear_y", "shear_z", "twist_deg", NULL};
  enum { X, FRACTION, MASS, TWIST = 11, TWIST_DEG = 18, COLUMNS };
  int column[COLUMNS], there[COLUMNS] = {0}, n = 0;
  fb_beam_desc *beam = &model.beam;
  do {
    const int k = text_choice(t, "a column", name);
    if (there[k]++) {
      text_fail(t, "the column %s is there twice", name[k]);
      return;
    }
    column[n++] = k;
  } while (text_more(t));
  if (there[X] + there[FRACTION] != 1 || there[TWIST] + there[TWIST_DEG] > 1) {
    text_fail(t, "the table wants one of x and fraction, and no more than one of twist and twist_deg");
  }
  if (!there[MASS]) {
    text_fail(t, "the table wants a column mass");
  }
  while (text_line(t)) {
    fb_section s;
    fb_real *const place[] = {&s.x,         &s.x,         &s.mass,    &s.EA,      &s.GJ,    &s.EI_y,   &s.EI_z,
                              &s.i_y,       &s.i_z,       &s.GA_y,    &s.GA_z,    &s.twist, &s.mass_y, &s.mass_z,
                              &s.tension_y, &s.tension_z, &s.shear_y, &s.shear_z, &s.twist};
    const char *const row = t->at + strspn(t->at, " ");
    if (strncmp(row, "end", 3) == 0 && strspn(row + 3, " ") == strlen(row + 3)) {
      return;
    }
    memset(&s, 0, sizeof s);
    for (int k = 0; k < n; k++) {
      const double x = text_number(t, name[column[k]]);
      *place[column[k]] = (fb_real)(column[k] == TWIST_DEG ? x * model_pi / 180.0 : x);
    }
    text_end_of_line(t);
    if (beam->n_station == FB_MAX_STATIONS) {
      text_fail(t, "more than %d stations", FB_MAX_STATIONS);
    }
    if (!t->failed && (beam->n_station == 0 ? fabs((double)s.x) > 0 : !(s.x > beam->station[beam->n_station - 1].x))) {
      text_fail(t, beam->n_station == 0 ? "the first station is at 0" : "stations must ascend");
    }
    if (!t->failed) {
      model_section_check(t, &s);
    }
    if (t->failed) {
      return;
    }
    model.is_fraction[beam->n_station] = there[FRACTION];
    beam->station[beam->n_station++] = s;
  }
  text_fail(t, "the table of stations wants a line `end`");
}

/* taper rectangle|tube X0 A0 B0 X1 A1 B1 N E G DENSITY */
static void model_taper(text_file *t)
{
  static const char *const kinds[] = {"rectangle", "tube", NULL};
  fb_profile end[2];
  fb_material material;
  int n;
  fb_status status;
  end[0].kind = end[1].kind = (fb_profile_kind)text_choice(t, "taper", kinds);
  for (int k = 0; k < 2; k++) {
    end[k].x = (fb_real)text_number(t, "x");
    text_reals(t, "size", end[k].size, 2);
  }
  n = text_whole(t, "number of stations", 2, FB_MAX_STATIONS);
  material.E = (fb_real)text_number(t, "E");
  material.G = (fb_real)text_number(t, "G");
  material.density = (fb_real)text_number(t, "density");
  text_end_of_line(t);
  status = t->failed ? FB_OK : fb_beam_desc_add_taper(&model.beam, &material, &end[0], &end[1], n);
  if (status != FB_OK) {
    text_fail(t, "%s", refusal_text(status));
  }
}

/* modes WORD NUMBER ... */
static void model_modes_line(text_file *t)
{
  static const char *const name[] = {"bend_y",   "bend_z",        "axial",  "torsion", "lowest",
                                     "limit_hz", "mass_fraction", "points", NULL};
  text_words seen = {0};
  int total = 0;
  model.has_modes = 1;
  do {
    const int k = text_choice(t, "modes", name);
    text_once(t, &seen, name[k]);
    if (k < 4) {
      model.modes.count[k] = text_whole(t, name[k], 0, FB_MAX_MODES);
      total += model.modes.count[k];
    } else if (k == 4) {
      model.modes.lowest = text_whole(t, name[k], 1, FB_MAX_MODES);
    } else if (k == 5) {
      model.modes.omega_limit = (fb_real)(text_number(t, name[k]) * 2.0 * model_pi);
    } else if (k == 7) {
      model.modes.line_points = text_whole(t, name[k], 2, FB_MAX_POINTS);
    } else {
      model.modes.mass_fraction = (fb_real)text_number(t, name[k]);
    }
  } while (text_more(t));
  if (total > FB_MAX_MODES) {
    text_fail(t, "%d modes, of %d at most", total, FB_MAX_MODES);
  }
}

/* The node that was read is one more, and may have a name. */
static void model_node_name(text_file *t)
{
  model.n_mark++;
  if (text_more(t)) {
    text_name(t, "a node", model.node_name[model.n_mark]);
  }
  for (int k = 1; k < model.n_mark && model.node_name[model.n_mark][0]; k++) {
    if (strcmp(model.node_name[k], model.node_name[model.n_mark]) == 0) {
      text_fail(t, "two nodes have the name %s", model.node_name[k]);
    }
  }
}

/* A degree of freedom of an element node, one more of a list. */
static void model_coordinate(text_file *t, fb_coordinate *list, int *n)
{
  static const char *const axes[] = {"x", "y", "z", "rx", "ry", "rz", NULL};
  if (*n == FB_MAX_COORDINATES) {
    text_fail(t, "more than %d of them", FB_MAX_COORDINATES);
    return;
  }
  list[*n].node = text_whole(t, "element node", 0, FB_MAX_ELEMENTS);
  list[(*n)++].axis = text_choice(t, "axis", axes);
}

/* Words about modes; 0 if word is none of them. */
static int model_modes_word(text_file *t, const char *word)
{
  static const char *const free_root[] = {"root_strain", NULL};
  fb_modes_desc *const modes = &model.modes;
  if (strcmp(word, "modes") == 0) {
    model_modes_line(t);
  } else if (strcmp(word, "functions") == 0) {
    modes->basis = FB_BASIS_FUNCTIONS;
    modes->degree = text_whole(t, "degree", 3, 8);
    modes->root_strain = text_more(t) ? 1 + text_choice(t, "after the degree", free_root) : 0;
  } else if (strcmp(word, "cubic") == 0) {
    modes->cubic = 1;
  } else if (strcmp(word, "boundary") == 0) {
    modes->basis = FB_BASIS_COMPONENT;
    model_coordinate(t, modes->boundary, &modes->n_boundary);
  } else if (strcmp(word, "load") == 0) {
    model_coordinate(t, modes->load, &modes->n_load);
  } else if (strcmp(word, "spin") == 0) {
    modes->spin = (fb_real)text_number(t, "spin");
    modes->spin_radius = (fb_real)text_number(t, "radius");
  } else if (strcmp(word, "preload") == 0) {
    modes->preload.force = (fb_real)text_number(t, "force");
    modes->preload.acceleration = (fb_real)text_number(t, "acceleration");
    modes->preload.spin = (fb_real)text_number(t, "spin");
    modes->preload.spin_radius = (fb_real)text_number(t, "radius");
  } else {
    return 0;
  }
  return 1;
}

static void model_lump(text_file *t)
{
  fb_lump *lump = &model.beam.lump[model.beam.n_lump];
  double inertia[6];
  if (model.beam.n_lump == FB_MAX_LUMPS) {
    text_fail(t, "more than %d lumps", FB_MAX_LUMPS);
    return;
  }
  lump->node = text_whole(t, "element node", 0, FB_MAX_ELEMENTS);
  lump->mass = (fb_real)text_number(t, "mass");
  if (lump->mass < FB_R(0.0)) {
    text_fail(t, "the mass of a lump is negative");
  }
  text_reals(t, "mass center", lump->center, 3);
  model_inertia(t, inertia);
  for (int i = 0; i < 6; i++) {
    lump->inertia[i] = (fb_real)inertia[i];
  }
  model.beam.n_lump++;
}

/* node X|tip [NAME] */
static void model_beam_node(text_file *t)
{
  if (model.n_mark == FB_MAX_NODES - 1) {
    text_fail(t, "more than %d nodes", FB_MAX_NODES - 1);
    return;
  }
  if (text_take(t, "tip")) {
    model.mark[model.n_mark] = -1;
  } else {
    model.mark[model.n_mark] = text_number(t, "the node's place");
    if (!t->failed && model.mark[model.n_mark] < 0) {
      text_fail(t, "the node's place is negative");
    }
  }
  model_node_name(t);
}

static void model_beam_line(text_file *t, const char *word)
{
  static const char *const roots[] = {"clamped", "pinned", "free", NULL};
  fb_beam_desc *beam = &model.beam;
  if (strcmp(word, "stations") == 0) {
    model_stations(t);
    return;
  }
  if (strcmp(word, "taper") == 0) {
    model_taper(t);
    return;
  }
  if (strcmp(word, "length") == 0) {
    beam->length = (fb_real)text_number(t, word);
    if (!t->failed && !(beam->length > FB_R(0.0))) {
      text_fail(t, "length must be greater than 0");
    }
  } else if (strcmp(word, "elements") == 0) {
    beam->n_element = text_whole(t, word, 1, FB_MAX_ELEMENTS);
    model.has_elements = 1;
  } else if (strcmp(word, "root") == 0) {
    beam->root = (fb_root)text_choice(t, word, roots);
  } else if (strcmp(word, "position") == 0) {
    text_reals(t, word, beam->position, 3);
  } else if (strcmp(word, "attitude") == 0) {
    text_reals(t, word, beam->attitude, 4);
    if (!t->failed && fabs((double)beam->attitude[0]) + fabs((double)beam->attitude[1]) +
                              fabs((double)beam->attitude[2]) + fabs((double)beam->attitude[3]) ==
                          0) {
      text_fail(t, "an attitude must not be zero");
    }
  } else if (strcmp(word, "point") == 0) {
    if (beam->n_point == FB_MAX_ELEMENTS + 1) {
      text_fail(t, "more than %d points", FB_MAX_ELEMENTS + 1);
      return;
    }
    text_reals(t, word, beam->point[beam->n_point++], 3);
  } else if (strcmp(word, "lump") == 0) {
    model_lump(t);
  } else if (strcmp(word, "node") == 0) {
    model_beam_node(t);
  } else if (!model_modes_word(t, word)) {
    text_fail(t, "no such word for a beam: %s", word);
    return;
  }
  text_end_of_line(t);
}

static model_node *model_find(text_file *t)
{
  const int id = text_whole(t, "node number", 0, 2000000000);
  for (int k = 0; k < model.n_node; k++) {
    if (model.node[k].id == id) {
      return &model.node[k];
    }
  }
  text_fail(t, "no node has the number %d", id);
  return &model.node[0];
}

static void model_component_line(text_file *t, const char *word)
{
  if (strcmp(word, "modes") == 0) {
    model.n_mode = text_whole(t, "number of modes", 1, FB_MAX_MODES);
  } else if (strcmp(word, "frequency_hz") == 0) {
    if (model.n_mode == 0) {
      text_fail(t, "modes must come before");
    }
    text_vector(t, "frequency", model.frequency, model.n_mode);
    for (int k = 0; k < model.n_mode && !t->failed; k++) {
      if (model.frequency[k] <= 0) {
        text_fail(t, "frequency %d must be greater than 0 (rigid modes are the frame's)", k + 1);
      }
    }
  } else if (strcmp(word, "node") == 0) {
    model_node *node = &model.node[model.n_node];
    if (model.n_node == MODEL_NODES) {
      text_fail(t, "more than %d nodes", MODEL_NODES);
      return;
    }
    memset(node, 0, sizeof *node);
    node->id = text_whole(t, "node number", 0, 2000000000);
    for (int k = 0; k < model.n_node && !t->failed; k++) {
      if (model.node[k].id == node->id) {
        text_fail(t, "node %d is there twice", node->id);
      }
    }
    text_vector(t, "place", node->x, 3);
    node->mass = text_number(t, "mass");
    if (node->mass < 0) {
      text_fail(t, "the mass is negative");
    }
    if (text_more(t)) {
      model_inertia(t, node->inertia);
    }
    model.n_node++;
  } else if (strcmp(word, "shape") == 0) {
    const int mode = model.n_mode > 0 ? text_whole(t, "mode", 1, model.n_mode) - 1 : 0;
    model_node *node = model_find(t);
    if (model.n_mode == 0) {
      text_fail(t, "modes must come before");
    } else if (node->have[mode]++) {
      text_fail(t, "mode %d of node %d is there twice", mode + 1, node->id);
    }
    text_vector(t, "displacement, rotation", node->shape + 6 * mode, 6);
  } else if (strcmp(word, "mark") == 0) {
    model_node *node = model_find(t);
    if (node->marked++ && !t->failed) {
      text_fail(t, "node %d is marked twice", node->id);
    }
    if (text_more(t)) {
      text_name(t, "a node", node->name);
    }
  } else if (strcmp(word, "quadratic") == 0) {
    if (model.n_mode == 0 || model.n_pair == FB_MAX_MODES * (FB_MAX_MODES + 1) / 2) {
      text_fail(t, model.n_mode ? "more pairs than there are" : "modes must come before");
      return;
    }
    model.pair[model.n_pair].a = text_whole(t, "mode", 1, model.n_mode) - 1;
    model.pair[model.n_pair].b = text_whole(t, "mode", 1, model.n_mode) - 1;
    for (int k = 0; k < model.n_pair && !t->failed; k++) {
      const int a = model.pair[model.n_pair].a, b = model.pair[model.n_pair].b;
      if ((model.pair[k].a == a && model.pair[k].b == b) || (model.pair[k].a == b && model.pair[k].b == a)) {
        text_fail(t, "the pair %d %d is there twice", a + 1, b + 1);
      }
    }
    text_vector(t, "p^chi", model.pair[model.n_pair].p, 3);
    text_vector(t, "h^chi", model.pair[model.n_pair].h, 3);
    text_vector(t, "Gamma^chi", model.pair[model.n_pair].gamma, 9);
    model.n_pair++;
  } else {
    text_fail(t, "no such word for a component: %s", word);
    return;
  }
  text_end_of_line(t);
}

static void model_rigid_line(text_file *t, const char *word)
{
  if (strcmp(word, "node") != 0) {
    text_fail(t, "no such word for a rigid body: %s", word);
  } else if (model.n_mark == FB_MAX_NODES - 1) {
    text_fail(t, "more than %d nodes", FB_MAX_NODES - 1);
  } else {
    text_vector(t, "the node's place", model.place[model.n_mark], 3);
    model_node_name(t);
  }
  text_end_of_line(t);
}

/* Effects and the data that they need. */
static void model_effects_check(text_file *t)
{
  const unsigned effects = model.level.effects;
  const fb_real *g = model.level.gravity;
  const int pulled = fabs((double)g[0]) + fabs((double)g[1]) + fabs((double)g[2]) > 0;
  if (!(effects & FB_EFFECT_ELASTIC) && (effects & FB_EFFECT_DAMPING)) {
    model_at(t, "effects");
    text_fail(t, "effects names damping but no modes: add linear, spin, full or large");
  }
  if (pulled && !(effects & FB_EFFECT_GRAVITY)) {
    model_at(t, "gravity");
    text_fail(t, "gravity is given, but not among the effects (full gravity, for instance)");
  }
  if (!pulled && (effects & FB_EFFECT_GRAVITY) && !text_seen(&model.seen, "gravity")) {
    model_at(t, "effects");
    text_fail(t, "the effect gravity wants a line gravity x y z");
  }
  if ((model.n_damping > 0) != ((effects & FB_EFFECT_DAMPING) != 0)) {
    model_at(t, model.n_damping ? "damping" : "effects");
    text_fail(t, model.n_damping
                     ? "damping is given, but not among the effects (full damping or large damping, for instance)"
                     : "the effect damping wants a line damping");
  }
}

static void model_component_check(text_file *t)
{
  const unsigned stiffening = FB_EFFECT_SPIN_STIFFENING | FB_EFFECT_ACCELERATION_STIFFENING;
  for (int k = 0; k < model.n_node; k++) {
    for (int a = 0; a < model.n_mode; a++) {
      if (!model.node[k].have[a]) {
        text_fail(t, "node %d has no shape of mode %d", model.node[k].id, a + 1);
      }
    }
  }
  if (model.n_node == 0 || model.n_mode == 0 || model.frequency[0] <= 0) {
    text_fail(t, "a component wants modes, frequency_hz, node and shape lines");
  }
  if (model.n_pair == 0 ? (model.level.effects & stiffening) != 0
                        : model.n_pair != model.n_mode * (model.n_mode + 1) / 2) {
    text_fail(t, model.n_pair ? "a quadratic line is missing: every pair of modes wants one"
                              : "stiffening wants quadratic lines; without them choose effects spin or linear");
  }
}

/* The line of a beam: its length, the places on it, its bends. */
static void model_beam_check(text_file *t)
{
  fb_beam_desc *beam = &model.beam;
  double length = (double)beam->length, before[3] = {0, 0, 0};
  if (beam->n_point > 0) {
    if (!model.has_elements) {
      beam->n_element = beam->n_point - 1;
    }
    if (beam->n_element != beam->n_point - 1 ||
        fabs((double)beam->point[0][0]) + fabs((double)beam->point[0][1]) + fabs((double)beam->point[0][2]) > 0) {
      text_fail(t, "a bent line of n elements wants n + 1 points, the first 0 0 0");
      return;
    }
    length = 0;
    for (int k = 1; k < beam->n_point; k++) {
      double d[3], size = 0, turn = 0;
      for (int i = 0; i < 3; i++) {
        d[i] = (double)beam->point[k][i] - (double)beam->point[k - 1][i];
        size += d[i] * d[i];
        turn += d[i] * before[i];
      }
      if (!(size > 0) || (k > 1 && !(turn > 0))) {
        text_fail(t, "point %d: neighbors are apart, and the line turns by less than 90 degrees", k + 1);
        return;
      }
      memcpy(before, d, sizeof d);
      length += sqrt(size);
    }
  }
  if (!(length > 0)) {
    text_fail(t, "a beam wants a length, or points");
  }
  for (int k = 0; k < beam->n_lump; k++) {
    if (beam->lump[k].node > beam->n_element) {
      text_fail(t, "lump %d is at element node %d of %d elements", k + 1, beam->lump[k].node, beam->n_element);
    }
  }
  if (beam->n_station == 0) {
    text_fail(t, "a beam wants stations or taper");
  }
  if (!model.has_modes) {
    text_fail(t, "a beam wants a line modes");
  }
  if (model.modes.cubic && model.modes.basis == FB_BASIS_FUNCTIONS) {
    model_at(t, "cubic");
    text_fail(t, "cubic is of natural and component modes: functions have a degree");
  }
  for (int k = 0; k < beam->n_station; k++) {
    beam->station[k].x *= model.is_fraction[k] ? (fb_real)length : FB_R(1.0);
  }
  if (beam->n_station > 1 && fabs((double)beam->station[beam->n_station - 1].x - length) > 1e-5 * length) {
    text_fail(t, "the last station is at %.10g, the tip at %.10g", (double)beam->station[beam->n_station - 1].x,
              length);
  } else if (beam->n_station > 1 && beam->n_point == 0) {
    beam->station[beam->n_station - 1].x = beam->length;
  }
  for (int k = 0; k < model.n_mark; k++) {
    model.mark[k] = model.mark[k] < 0 ? length : model.mark[k];
    if (model.mark[k] > length * (1 + 1e-5)) {
      text_fail(t, "a node at %.10g is beyond the tip at %.10g", model.mark[k], length);
    }
  }
}

/* Refuses a word that was there before, but for those of which there may be many. */
static void model_once(text_file *t, const char *word)
{
  static const char *const many[] = {"point", "lump", "load",      "node",    "taper",
                                     "shape", "mark", "quadratic", "boundary"};
  for (int k = 0; k < (int)(sizeof many / sizeof many[0]); k++) {
    if (strcmp(word, many[k]) == 0) {
      text_note(t, &model.seen, word);
      return;
    }
  }
  text_once(t, &model.seen, word);
}

/* Of a body of that kind nothing is known yet. */
static void model_begin(model_kind kind)
{
  memset(&model, 0, sizeof model);
  fb_shape_init(&model_shape, 0);
  strcpy(model.name, "flexible_body");
  model.kind = kind;
  model.level.effects = kind == MODEL_RIGID ? FB_EFFECTS_RIGID : FB_EFFECTS_FULL;
  model.beam.n_element = FB_MAX_ELEMENTS / 2;
}

/* A line that begins with that word. */
static void model_line(text_file *t, const char *word)
{
  static void (*const line[])(text_file * t, const char *word) = {model_beam_line, model_component_line,
                                                                  model_rigid_line};
  model_once(t, word);
  if (!model_common(t, word)) {
    line[model.kind](t, word);
  }
}

/* What only the whole description tells. */
static void model_check(text_file *t)
{
  model_effects_check(t);
  if (!t->failed && model.kind == MODEL_BEAM) {
    model_beam_check(t);
  } else if (!t->failed && model.kind == MODEL_COMPONENT) {
    model_component_check(t);
  }
}

/* The lines of a file. */
static void model_lines(text_file *t)
{
  if (!text_line(t)) {
    text_fail(t, "is empty");
  }
  model_begin((model_kind)text_choice(t, "the first word", model_kinds));
  text_end_of_line(t);
  while (text_line(t)) {
    model_line(t, text_word(t));
  }
}

/* Reads a description; 0 when something is wrong, which has then been said. */
static inline int model_read(const char *program, const char *file)
{
  text_file t;
  if (!text_open(&t, program, file)) {
    return 0;
  }
  model_lines(&t);
  t.line = 0; /* what is missing has no line */
  model_check(&t);
  text_close(&t);
  return !t.failed;
}

/* The shape of a component: modes scaled to unit modal mass, so that K is omega^2. */
static fb_status model_component_shape(const char **what)
{
  static char at_node[32];
  fb_real psi[3 * FB_MAX_MODES], theta[3 * FB_MAX_MODES], r[3], inertia[6], scale[FB_MAX_MODES];
  fb_status status = FB_OK;
  for (int pass = 0; pass < 2 && status == FB_OK; pass++) {
    status = fb_shape_init(&model_shape, model.n_mode);
    for (int k = 0; k < model.n_node && status == FB_OK; k++) {
      const model_node *node = &model.node[k];
      for (int i = 0; i < 3 * model.n_mode; i++) {
        const fb_real s = pass ? scale[i / 3] : FB_R(1.0);
        psi[i] = s * (fb_real)node->shape[6 * (i / 3) + i % 3];
        theta[i] = s * (fb_real)node->shape[6 * (i / 3) + 3 + i % 3];
      }
      for (int i = 0; i < 6; i++) {
        inertia[i] = (fb_real)node->inertia[i];
        r[i % 3] = (fb_real)node->x[i % 3];
      }
      status = fb_shape_add_lump(&model_shape, (fb_real)node->mass, r, inertia, psi, theta);
      snprintf(at_node, sizeof at_node, "node %d", node->id);
      *what = status == FB_OK ? "the component" : at_node;
      if (status == FB_OK && pass && node->marked) {
        int at;
        status = fb_shape_add_node(&model_shape, &at, r, psi, theta);
        if (status == FB_OK) {
          strcpy(model.node_name[at], node->name);
        }
      }
    }
    for (int a = 0; a < model.n_mode && status == FB_OK; a++) {
      const fb_real m = model_shape.M[a * (model.n_mode + 1)], w = (fb_real)(2.0 * model_pi * model.frequency[a]);
      status = m > FB_R(0.0) ? FB_OK : FB_ERR_SINGULAR;
      scale[a] = FB_R(1.0) / FB_SQRT(m);
      model_shape.K[a * (model.n_mode + 1)] = w * w;
    }
  }
  for (int k = 0; k < model.n_pair && status == FB_OK; k++) {
    const fb_real s = scale[model.pair[k].a] * scale[model.pair[k].b];
    fb_real p[3], h[3], gamma[9];
    for (int i = 0; i < 9; i++) {
      p[i % 3] = s * (fb_real)model.pair[k].p[i % 3];
      h[i % 3] = s * (fb_real)model.pair[k].h[i % 3];
      gamma[i] = s * (fb_real)model.pair[k].gamma[i];
    }
    status = fb_shape_add_pair(&model_shape, model.pair[k].a, model.pair[k].b, p, h, gamma);
  }
  return status;
}

static fb_status model_beam_shape(const char **what)
{
  fb_status status;
  int at;
  *what = "the beam";
  status = fb_beam_init(&model_beam, &model.beam);
  if (status == FB_OK) {
    *what = "its modes";
    status = fb_modes_solve(&model_modes, &model_modes_work, &model_beam, &model.modes);
  }
  *what = status == FB_OK ? "its integrals" : *what;
  status = status ? status : fb_shape_init(&model_shape, model_modes.n);
  status = status ? status : fb_shape_add_beam(&model_shape, 0, &model_beam, &model_modes);
#if FB_WITH_NONLINEAR_STRAIN
  if (status == FB_OK && (model.level.effects & FB_EFFECT_NONLINEAR_STRAIN)) {
    *what = "its strain stations (they want EA, and `functions` with as many axial modes as bending ones)";
    status = fb_shape_add_beam_strain(&model_shape, 0, &model_beam, &model_modes);
  }
#endif
  for (int k = 0; k < model.n_mark && status == FB_OK; k++) {
    *what = "a node";
    status = fb_shape_add_beam_node(&model_shape, &at, 0, &model_beam, &model_modes, (fb_real)model.mark[k]);
  }
  return status;
}

/* A body without modes; its nodes are held to its frame. */
static fb_status model_rigid_shape(const char **what)
{
  fb_status status = fb_shape_init(&model_shape, 0);
  *what = "a node";
  for (int k = 0; k < model.n_mark && status == FB_OK; k++) {
    const fb_real none[3] = {0},
                  r[3] = {(fb_real)model.place[k][0], (fb_real)model.place[k][1], (fb_real)model.place[k][2]};
    int at;
    status = fb_shape_add_node(&model_shape, &at, r, none, none);
  }
  return status;
}

/* Builds the shape of what was read; on failure *what says at which part. */
static fb_status model_build_shape(const char **what)
{
  static fb_status (*const shape[])(const char **what) = {model_beam_shape, model_component_shape, model_rigid_shape};
  fb_status status;
  fb_real center[3], inertia[6];
  *what = "the component";
  status = shape[model.kind](what);
  for (int i = 0; i < 6; i++) {
    center[i % 3] = (fb_real)model.hub_center[i % 3];
    inertia[i] = (fb_real)model.hub_inertia[i];
  }
  if (status == FB_OK && model.hub) {
    *what = "the hub";
    status = fb_shape_add_rigid(&model_shape, (fb_real)model.hub_mass, center, inertia);
  }
  if (status == FB_OK && model.n_damping > 1 && model.n_damping != model_shape.n) {
    *what = "damping wants one ratio, or as many as there are modes";
    return FB_ERR_VALUE;
  }
  if (status == FB_OK && model_shape.n == 0 && (model.level.effects & FB_EFFECT_ELASTIC)) {
    *what = "no mode is left";
    return FB_ERR_MODES;
  }
  return status;
}

/* Builds the body of it. */
static inline fb_status model_build(const char **what)
{
  const fb_status status = model_build_shape(what);
  *what = status == FB_OK ? "the body" : *what;
  return status ? status : fb_body_init(&model_body, &model_body_work, &model_shape, &model.level);
}
#endif
