/* model.h - text descriptions of a body, read into a fb_body. README.md lists the words.
   Include flexbeam.h first. Everything is static: one model at a time. */
#ifndef MODEL_H
#define MODEL_H
#include "inside.h"
#include "../common/clear.h"
#include "../common/refusal.h"
#include "../common/section_doubt.h"
#include "../common/text.h"
#include "../common/rotor_text.h"

#define MODEL_NODES 4096 /* of a finite-element component */

typedef enum model_kind { MODEL_BEAM, MODEL_COMPONENT, MODEL_RIGID, MODEL_PARTS } model_kind;
static const char *const model_kinds[] = {"beam", "component", "rigid", "parts", NULL};

typedef struct model_node {
  int id, marked;
  char name[TEXT_NAME];
  double x[3], mass, inertia[6];
  double shape[6 * FB_MAX_MODES]; /* displacement and rotation by mode */
  int have[FB_MAX_MODES];
  int line, straight; /* 1: on a line; without rotations */
  int from;           /* index of the node of the line before it; -1: of none, or of the frame at `root` */
  double root[3];
  int rooted;
} model_node;

enum { MODEL_QUADRATIC = 1, MODEL_GEOMETRIC = 2, MODEL_LINE = 4 }; /* what gives the second order of a component */

typedef struct model_part { /* a beam, or nodes and shapes of a finite-element program */
  model_kind kind;
  char name[TEXT_NAME]; /* empty: the description is this part */
  int line;             /* of its block */
  text_words seen;      /* in its block */
  fb_real position[3], attitude[4];
  int n_damping; /* ratios of its own */
  double zeta[FB_MAX_MODES];
  fb_beam_desc beam;
  fb_modes_desc modes;
  int is_fraction[FB_MAX_STATIONS]; /* x of a station is to be multiplied by the length */
  int station_line[FB_MAX_STATIONS];
  int has_elements, has_modes;
  int n_mode, node, n_node, pair, n_pair; /* of a component: its first of all nodes, of all pairs */
  int second;                             /* MODEL_QUADRATIC, _GEOMETRIC, _LINE */
  double frequency[FB_MAX_MODES];
  int first, n; /* its coordinates, once built */
} model_part;

static struct model {
  char name[64];
  model_kind kind;
  double hub_mass, hub_center[3], hub_inertia[6];
  fb_body_desc level;
  int says_effects; /* a line does; else what has a line of its own is one, too: damping, gravity */
  double zeta;      /* of parts without a damping of their own */
  int by_frequency; /* damping ratios differ, and count modes by frequency, not coordinates: see model_damp_parts */
  int hub, n_damping, n_part, n_node, n_pair, n_mark, built; /* built: the last part tried, -1: the whole */
  char warning[160]; /* the first of what may be a mistake, though it is read; empty: none */
  char doubt[FB_MAX_PARTS * (SECTION_DOUBT + 64)]; /* sections of no material in SI units, of each beam the first */
  text_words seen;
  model_part part[FB_MAX_PARTS]; /* of a beam and a component one, of a rigid body none */
  struct {                       /* nodes of the hub and of beams */
    int part;                    /* -1: the hub */
    double x[3];                 /* of a beam: how far along it, below 0: its tip */
    char name[TEXT_NAME];
  } mark[FB_MAX_NODES];
  struct { /* the rest of level.rotor */
    rotor_text text;
    char node[TEXT_NAME]; /* name or number; empty: the frame */
    double momentum;      /* [N m s] where it is given */
  } rotor[FB_MAX_ROTORS];
  char node_name[FB_MAX_NODES][TEXT_NAME]; /* of all nodes, once built; empty: none */
  int node_part[FB_MAX_NODES];             /* -1: the hub */
  model_node node[MODEL_NODES];
  struct {
    int a, b;
    double p[3], h[3], gamma[9];
  } pair[FB_MAX_MODES * (FB_MAX_MODES + 1) / 2];
} model;

static fb_beam model_beam[FB_MAX_PARTS];
static fb_modes model_modes[FB_MAX_PARTS];
static fb_real model_scale[FB_MAX_PARTS][FB_MAX_MODES]; /* of the modes of components, to unit modal mass */
static fb_modes_work model_modes_work;
static fb_shape model_shape;
static fb_body model_body;
static fb_body_work model_body_work;

static const double model_pi = 3.14159265358979324;

/* The words that a part had: of its block, or of the description that it is. */
static text_words *model_seen(model_part *part)
{
  return part && part->name[0] ? &part->seen : &model.seen;
}

/* The complaint that follows is about the line of that word of a part (NULL: of the whole), if it was there. */
static void model_at(text_file *t, model_part *part, const char *word)
{
  const int line = text_seen(model_seen(part), word);
  t->line = line > 0 ? line : t->line;
}

/* W X Y Z of a quaternion, or turns about own axes one after the other, in degrees: x 90 z 30. */
static void model_attitude(text_file *t, double quat[4])
{
  static const char *const axes[] = {"x", "y", "z", NULL};
  const char *const next = t->at + strspn(t->at, " ");
  fb_real q[4] = {1, 0, 0, 0};
  if (next[0] < 'x' || next[0] > 'z') {
    text_vector(t, "attitude", quat, 4);
    if (!t->failed && !(fabs(quat[0]) + fabs(quat[1]) + fabs(quat[2]) + fabs(quat[3]) > 0)) {
      text_fail(t, "an attitude must not be zero");
    }
    return;
  }
  do {
    fb_real turn[3] = {0, 0, 0}, by[4], before[4];
    const int axis = text_choice(t, "axis of a turn", axes);
    turn[axis] = (fb_real)(text_degrees(t, "degrees"));
    fb_quat_from_rotvec(by, turn);
    memcpy(before, q, sizeof before);
    fb_quat_mul(q, before, by);
  } while (text_more(t));
  for (int i = 0; i < 4; i++) {
    quat[i] = (double)q[i];
  }
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
  model.says_effects = 1;
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

/* Damping ratios, one for all or one per mode: how many there are. */
static int model_damping(text_file *t, double zeta[FB_MAX_MODES])
{
  int n = 0;
  memset(zeta, 0, FB_MAX_MODES * sizeof *zeta);
  do {
    if (n == FB_MAX_MODES) {
      text_fail(t, "more than %d damping ratios", FB_MAX_MODES);
      return n;
    }
    zeta[n++] = text_number(t, "damping ratio");
    if (zeta[n - 1] < 0) {
      text_fail(t, "a damping ratio is negative");
    }
  } while (text_more(t));
  for (int k = 1; k < FB_MAX_MODES && n == 1; k++) { /* one for all */
    zeta[k] = zeta[0];
  }
  return n;
}

/* momentum H: it stays that */
static int model_rotor_drive(text_file *t, void *user, const char *word)
{
  const int k = model.level.n_rotor;
  (void)user;
  if (strcmp(word, "motor") == 0) {
    text_fail(t, "the motor of a rotor is not in its description: a scene has one, or a program");
  } else if (strcmp(word, "momentum") == 0) {
    model.level.rotor[k].given = 1;
    model.rotor[k].momentum = text_number(t, word);
  } else {
    return 0;
  }
  return 1;
}

/* like OTHER X Y Z */
static void model_rotor_like(text_file *t)
{
  const int n = model.level.n_rotor;
  const char *const word = text_word(t);
  int k = 0;
  while (k < n && word && strcmp(model.rotor[k].text.name, word) != 0) {
    k++;
  }
  if (k == n) {
    text_fail(t, "no rotor has the name %s", word ? word : "(missing)");
    return;
  }
  memcpy(model.rotor[n].node, model.rotor[k].node, sizeof model.rotor[n].node);
  model.rotor[n].momentum = model.rotor[k].momentum;
  rotor_like(t, &model.rotor[n].text, &model.level.rotor[n], &model.rotor[k].text, &model.level.rotor[k]);
  text_end_of_line(t);
  model.level.n_rotor++;
}

/* rotor NAME [NODE], its lines, end; or rotor NAME like OTHER X Y Z */
static void model_rotor(text_file *t)
{
  const int n = model.level.n_rotor;
  if (n == FB_MAX_ROTORS) {
    text_fail(t, "more than %d rotors", FB_MAX_ROTORS);
    return;
  }
  model.rotor[n].text.line = t->line;
  text_name(t, "a rotor", model.rotor[n].text.name);
  for (int k = 0; k < n; k++) {
    if (strcmp(model.rotor[k].text.name, model.rotor[n].text.name) == 0) {
      text_fail(t, "two rotors have the name %s", model.rotor[n].text.name);
    }
  }
  if (text_take(t, "like")) {
    model_rotor_like(t);
    return;
  }
  if (text_more(t)) {
    const char *const node = text_word(t);
    if (strlen(node) >= sizeof model.rotor[n].node) { /* not that whose name it begins with */
      text_fail(t, "rotor %s: no node has the name or number %s", model.rotor[n].text.name, node);
    }
    snprintf(model.rotor[n].node, sizeof model.rotor[n].node, "%s", node);
  }
  text_end_of_line(t);
  if (!t->failed) {
    rotor_block(t, &model.rotor[n].text, &model.level.rotor[n], model_rotor_drive, NULL);
    model.level.n_rotor++;
  }
}

/* Words that every model may have; 0 if word is none of them. */
static int model_common(text_file *t, const char *word)
{
  static const char *const bases[] = {"free", "prescribed", "pinned", "hinged", NULL};
  double zeta[FB_MAX_MODES];
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
  } else if (strcmp(word, "rotor") == 0) {
    model_rotor(t);
  } else if (strcmp(word, "damping") == 0) {
    model.n_damping = model_damping(t, zeta);
    model.zeta = zeta[0];
    for (int k = 0; k < FB_MAX_MODES; k++) {
      model.level.zeta[k] = (fb_real)zeta[k];
    }
  } else {
    return 0;
  }
  text_end_of_line(t);
  return 1;
}

/* What a section must obey, with the line it stands on. */
static void model_section_check(text_file *t, const fb_beam_desc *beam, const fb_section *s)
{
  const fb_section *first = &beam->station[0];
  const fb_real positive[] = {s->mass, s->EA, s->GJ, s->EI_y, s->EI_z, s->i_y, s->i_z, s->GA_y, s->GA_z};
  static const char *const name[] = {"mass", "EA", "GJ", "EI_y", "EI_z", "i_y", "i_z", "GA_y", "GA_z"};
  for (int k = 0; k < 9; k++) {
    if (positive[k] < FB_R(0.0)) {
      text_fail(t, "%s is negative", name[k]);
    }
  }
  if ((s->GA_y > FB_R(0.0)) != (s->GA_z > FB_R(0.0)) ||
      (beam->n_station > 0 && (s->GA_y > FB_R(0.0)) != (first->GA_y > FB_R(0.0)))) {
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
static void model_stations(text_file *t, model_part *part)
{
  static const char *const name[] = {"x",         "fraction",  "mass",    "EA",      "GJ",        "EI_y",   "EI_z",
                                     "i_y",       "i_z",       "GA_y",    "GA_z",    "twist",     "mass_y", "mass_z",
                                     "tension_y", "tension_z", "shear_y", "shear_z", "twist_deg", NULL};
  enum { X, FRACTION, MASS, TWIST = 11, TWIST_DEG = 18, COLUMNS };
  int column[COLUMNS], there[COLUMNS] = {0}, n = 0;
  fb_beam_desc *const beam = &part->beam;
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
  text_begin(t, "table of stations", "");
  while (text_within(t)) {
    fb_section s;
    fb_real *const place[] = {&s.x,         &s.x,         &s.mass,    &s.EA,      &s.GJ,    &s.EI_y,   &s.EI_z,
                              &s.i_y,       &s.i_z,       &s.GA_y,    &s.GA_z,    &s.twist, &s.mass_y, &s.mass_z,
                              &s.tension_y, &s.tension_z, &s.shear_y, &s.shear_z, &s.twist};
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
      model_section_check(t, beam, &s);
    }
    if (!t->failed) {
      part->is_fraction[beam->n_station] = there[FRACTION];
      part->station_line[beam->n_station] = t->line;
      beam->station[beam->n_station++] = s;
    }
  }
}

/* taper rectangle|tube X0 A0 B0 X1 A1 B1 N E G DENSITY */
static void model_taper(text_file *t, model_part *part)
{
  fb_beam_desc *const beam = &part->beam;
  const int first = beam->n_station;
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
  status = t->failed ? FB_OK : fb_beam_desc_add_taper(beam, &material, &end[0], &end[1], n);
  for (int k = first; k < beam->n_station; k++) {
    part->station_line[k] = t->line;
  }
  if (status != FB_OK) {
    text_fail(t, "%s", refusal_text(status));
  }
}

/* modes WORD NUMBER ... */
static void model_modes_line(text_file *t, fb_modes_desc *modes)
{
  static const char *const name[] = {"bend_y",   "bend_z",        "axial",  "torsion", "lowest",
                                     "limit_hz", "mass_fraction", "points", NULL};
  text_words seen = {0};
  int total = 0;
  do {
    const int k = text_choice(t, "modes", name);
    text_once(t, &seen, name[k]);
    if (k < 4) {
      modes->count[k] = text_whole(t, name[k], 0, FB_MAX_MODES);
      total += modes->count[k];
    } else if (k == 4) {
      modes->lowest = text_whole(t, name[k], 1, FB_MAX_MODES);
    } else if (k == 5) {
      modes->omega_limit = (fb_real)(text_number(t, name[k]) * 2.0 * model_pi);
    } else if (k == 7) {
      modes->line_points = text_whole(t, name[k], 2, FB_MAX_POINTS);
    } else {
      modes->mass_fraction = (fb_real)text_number(t, name[k]);
    }
  } while (text_more(t));
  if (total > FB_MAX_MODES) {
    text_fail(t, "%d modes, of %d at most", total, FB_MAX_MODES);
  }
}

/* The node that was read is one more, of that part (-1: of the hub), and may have a name. */
static void model_node_name(text_file *t, int part)
{
  const int n = model.n_mark++;
  model.mark[n].part = part;
  if (text_more(t)) {
    text_name(t, "a node", model.mark[n].name);
  }
  for (int k = 0; k < n && model.mark[n].name[0]; k++) {
    if (strcmp(model.mark[k].name, model.mark[n].name) == 0) {
      text_fail(t, "two nodes have the name %s", model.mark[k].name);
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
static int model_modes_word(text_file *t, model_part *part, const char *word)
{
  static const char *const free_root[] = {"root_strain", NULL};
  fb_modes_desc *const modes = &part->modes;
  if (strcmp(word, "modes") == 0) {
    part->has_modes = 1;
    model_modes_line(t, modes);
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

static void model_lump(text_file *t, fb_beam_desc *beam)
{
  fb_lump *lump = &beam->lump[beam->n_lump];
  double inertia[6];
  if (beam->n_lump == FB_MAX_LUMPS) {
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
  beam->n_lump++;
}

/* node X|tip [NAME] */
static void model_beam_node(text_file *t, const model_part *part)
{
  double *const x = model.mark[model.n_mark].x;
  if (model.n_mark == FB_MAX_NODES - 1) {
    text_fail(t, "more than %d nodes", FB_MAX_NODES - 1);
    return;
  }
  if (text_take(t, "tip")) {
    x[0] = -1;
  } else {
    x[0] = text_number(t, "the node's place");
    if (!t->failed && x[0] < 0) {
      text_fail(t, "the node's place is negative");
    }
  }
  model_node_name(t, (int)(part - model.part));
}

static void model_beam_line(text_file *t, model_part *part, const char *word)
{
  static const char *const roots[] = {"clamped", "pinned", "free", NULL};
  fb_beam_desc *const beam = &part->beam;
  if (strcmp(word, "stations") == 0) {
    model_stations(t, part);
    return;
  }
  if (strcmp(word, "taper") == 0) {
    model_taper(t, part);
    return;
  }
  if (strcmp(word, "length") == 0) {
    beam->length = (fb_real)text_number(t, word);
    if (!t->failed && !(beam->length > FB_R(0.0))) {
      text_fail(t, "length must be greater than 0");
    }
  } else if (strcmp(word, "elements") == 0) {
    beam->n_element = text_whole(t, word, 1, FB_MAX_ELEMENTS);
    part->has_elements = 1;
  } else if (strcmp(word, "root") == 0) {
    beam->root = (fb_root)text_choice(t, word, roots);
  } else if (strcmp(word, "point") == 0) {
    if (beam->n_point == FB_MAX_ELEMENTS + 1) {
      text_fail(t, "more than %d points", FB_MAX_ELEMENTS + 1);
      return;
    }
    text_reals(t, word, beam->point[beam->n_point++], 3);
  } else if (strcmp(word, "lump") == 0) {
    model_lump(t, beam);
  } else if (strcmp(word, "node") == 0) {
    model_beam_node(t, part);
  } else if (!model_modes_word(t, part, word)) {
    text_fail(t, "no such word for a beam: %s", word);
    return;
  }
  text_end_of_line(t);
}

static model_node *model_find(text_file *t, const model_part *part)
{
  const int id = text_whole(t, "node number", 0, 2000000000);
  for (int k = 0; k < part->n_node; k++) {
    if (model.node[part->node + k].id == id) {
      return &model.node[part->node + k];
    }
  }
  text_fail(t, "no node has the number %d", id);
  return &model.node[0];
}

/* Modes of the components so far. */
static int model_count_modes(void)
{
  int n = 0;
  for (int k = 0; k < model.n_part; k++) {
    n += model.part[k].n_mode;
  }
  return n;
}

/* quadratic MODE MODE p^chi (3) h^chi (3) Gamma^chi (9), or geometric MODE MODE and the geometric stiffness by
   accelerations (3), angular accelerations (3) and spins (6) of the frame */
static void model_pair_line(text_file *t, model_part *part, int geometric)
{
  fb_real by[12];
  if (part->n_mode == 0 || model.n_pair == FB_MAX_MODES * (FB_MAX_MODES + 1) / 2) {
    text_fail(t, part->n_mode ? "more pairs than there are" : "modes must come before");
    return;
  }
  model.pair[model.n_pair].a = text_whole(t, "mode", 1, part->n_mode) - 1;
  model.pair[model.n_pair].b = text_whole(t, "mode", 1, part->n_mode) - 1;
  for (int k = part->pair; k < model.n_pair && !t->failed; k++) {
    const int a = model.pair[model.n_pair].a, b = model.pair[model.n_pair].b;
    if ((model.pair[k].a == a && model.pair[k].b == b) || (model.pair[k].a == b && model.pair[k].b == a)) {
      text_fail(t, "the pair %d %d is there twice", a + 1, b + 1);
    }
  }
  if (geometric) {
    text_reals(t, "stiffness by accelerations x y z, angular ones x y z, spins xx yy zz xy xz yz", by, 12);
    if (!t->failed && fb_shape_init(&model_shape, 1) == FB_OK && /* built afresh later */
        fb_shape_add_stiffening(&model_shape, 0, 0, by, by + 3, by + 6) == FB_OK) {
      for (int i = 0; i < 9; i++) {
        model.pair[model.n_pair].p[i % 3] = (double)model_shape.second.pchi[i % 3];
        model.pair[model.n_pair].h[i % 3] = (double)model_shape.second.hchi[i % 3];
        model.pair[model.n_pair].gamma[i] = (double)model_shape.second.Gamchi[i];
      }
    }
  } else {
    text_vector(t, "p^chi", model.pair[model.n_pair].p, 3);
    text_vector(t, "h^chi", model.pair[model.n_pair].h, 3);
    text_vector(t, "Gamma^chi", model.pair[model.n_pair].gamma, 9);
  }
  part->second |= geometric ? MODEL_GEOMETRIC : MODEL_QUADRATIC;
  model.n_pair++;
  part->n_pair++;
}

/* line [straight] [frame X Y Z] NODE NODE ...: the nodes follow each other along a line */
static void model_line_line(text_file *t, model_part *part)
{
  const int is_straight = text_take(t, "straight"), rooted = text_take(t, "frame");
  double root[3] = {0};
  int from = -1, n = 0;
  part->second |= MODEL_LINE;
  if (rooted) {
    text_vector(t, "where the line begins on the frame", root, 3);
  }
  do {
    model_node *const node = model_find(t, part);
    const int at = (int)(node - model.node);
    if (t->failed) {
      return;
    }
    if (n == 0 && !rooted && node->line) { /* it goes on from a line before */
      from = at;
      n++;
      continue;
    }
    if (node->line) {
      text_fail(t, "node %d is on a line before: a line begins there, or leaves it out", node->id);
      return;
    }
    node->line = 1;
    node->straight = is_straight;
    node->from = from;
    node->rooted = n == 0 && rooted;
    memcpy(node->root, root, sizeof root);
    from = at;
    n++;
  } while (text_more(t));
  if (n + rooted < 2) {
    text_fail(t, "a line wants two places at least");
  }
}

static void model_component_line(text_file *t, model_part *part, const char *word)
{
  if (strcmp(word, "modes") == 0) {
    const int before = model_count_modes();
    part->n_mode = text_whole(t, "number of modes", 1, FB_MAX_MODES);
    if (before + part->n_mode > FB_MAX_MODES) {
      text_fail(t, "%d modes of components, of %d at most", before + part->n_mode, FB_MAX_MODES);
    }
  } else if (strcmp(word, "frequency_hz") == 0) {
    if (part->n_mode == 0) {
      text_fail(t, "modes must come before");
    }
    text_vector(t, "frequency", part->frequency, part->n_mode);
    for (int k = 0; k < part->n_mode && !t->failed; k++) {
      if (part->frequency[k] <= 0) {
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
    for (int k = 0; k < part->n_node && !t->failed; k++) {
      if (model.node[part->node + k].id == node->id) {
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
    part->n_node++;
  } else if (strcmp(word, "shape") == 0) {
    const int mode = part->n_mode > 0 ? text_whole(t, "mode", 1, part->n_mode) - 1 : 0;
    model_node *node = model_find(t, part);
    if (part->n_mode == 0) {
      text_fail(t, "modes must come before");
    } else if (node->have[mode]++) {
      text_fail(t, "mode %d of node %d is there twice", mode + 1, node->id);
    }
    text_vector(t, "displacement, rotation", node->shape + 6 * mode, 6);
  } else if (strcmp(word, "mark") == 0) {
    model_node *node = model_find(t, part);
    if (node->marked++ && !t->failed) {
      text_fail(t, "node %d is marked twice", node->id);
    }
    if (text_more(t)) {
      text_name(t, "a node", node->name);
    }
  } else if (strcmp(word, "quadratic") == 0 || strcmp(word, "geometric") == 0) {
    model_pair_line(t, part, word[0] == 'g');
  } else if (strcmp(word, "line") == 0) {
    model_line_line(t, part);
  } else {
    text_fail(t, "no such word for a component: %s", word);
    return;
  }
  text_end_of_line(t);
}

/* node X Y Z [NAME] */
static void model_hub_node(text_file *t)
{
  if (model.n_mark == FB_MAX_NODES - 1) {
    text_fail(t, "more than %d nodes", FB_MAX_NODES - 1);
    return;
  }
  text_vector(t, "the node's place", model.mark[model.n_mark].x, 3);
  model_node_name(t, -1);
  text_end_of_line(t);
}

/* Has the whole or a part a line damping? */
static int model_is_damped(void)
{
  int is = model.n_damping > 0;
  for (int k = 0; k < model.n_part; k++) {
    is |= model.part[k].n_damping > 0;
  }
  return is;
}

/* Effects and the data that they need. */
static void model_effects_check(text_file *t)
{
  const fb_real *g = model.level.gravity;
  const int pulled = fabs((double)g[0]) + fabs((double)g[1]) + fabs((double)g[2]) > 0;
  const int tacit = !model.says_effects && model.kind != MODEL_RIGID;
  const unsigned effects = model.level.effects |= (tacit && model_is_damped() ? (unsigned)FB_EFFECT_DAMPING : 0u) |
                                                  (tacit && pulled ? (unsigned)FB_EFFECT_GRAVITY : 0u);
  if (!(effects & FB_EFFECT_ELASTIC) && (effects & FB_EFFECT_DAMPING)) {
    model_at(t, NULL, "effects");
    text_fail(t, "effects names damping but no modes: add linear, spin, full or large");
  }
  if (pulled && !(effects & FB_EFFECT_GRAVITY)) {
    model_at(t, NULL, "gravity");
    text_fail(t, "gravity is given, but not among the effects (full gravity, for instance)");
  }
  if (!pulled && (effects & FB_EFFECT_GRAVITY) && !text_seen(&model.seen, "gravity")) {
    model_at(t, NULL, "effects");
    text_fail(t, "the effect gravity wants a line gravity x y z");
  }
  for (int k = 0; k < model.n_part && model.n_damping > 1; k++) {
    if (model.part[k].n_damping > 0) {
      model_at(t, NULL, "damping");
      text_fail(t, "damping of the whole has one ratio where a part has its own: it is that of the other parts");
    }
  }
  if (model_is_damped() != ((effects & FB_EFFECT_DAMPING) != 0)) {
    for (int k = 0; k < model.n_part; k++) {
      model_at(t, &model.part[k], "damping");
    }
    model_at(t, NULL, model_is_damped() ? "damping" : "effects");
    text_fail(t, model_is_damped()
                     ? "damping is given, but not among the effects (full damping or large damping, for instance)"
                     : "the effect damping wants a line damping");
  }
}

/* Stiffening needs the second-order displacement of every component. */
static void model_quadratic_check(text_file *t)
{
  const unsigned stiffening = FB_EFFECT_SPIN_STIFFENING | FB_EFFECT_ACCELERATION_STIFFENING;
  for (int k = 0; k < model.n_part && (model.level.effects & stiffening); k++) {
    const model_part *const part = &model.part[k];
    if (part->kind == MODEL_COMPONENT && part->second == 0) {
      t->line = part->line > 0 ? part->line : t->line;
      text_fail(t, "stiffening wants line, geometric or quadratic lines; without them choose effects spin or linear");
    }
  }
}

static int model_moves(const model_node *node, int n)
{
  double most = 0;
  for (int k = 0; k < 6 * n; k++) {
    most = fmax(most, fabs(node->shape[k]));
  }
  return most > 0;
}

static void model_component_check(text_file *t, model_part *part)
{
  for (int k = 0; k < part->n_node; k++) {
    const model_node *const node = &model.node[part->node + k];
    for (int a = 0; a < part->n_mode; a++) {
      if (!node->have[a]) {
        text_fail(t, "node %d has no shape of mode %d", node->id, a + 1);
      }
    }
  }
  if (part->n_node == 0 || part->n_mode == 0 || part->frequency[0] <= 0) {
    text_fail(t, "a component wants modes, frequency_hz, node and shape lines");
  }
  if (part->n_pair > 0 && part->n_pair != part->n_mode * (part->n_mode + 1) / 2) {
    text_fail(t, "a %s line is missing: every pair of modes wants one",
              part->second & MODEL_GEOMETRIC ? "geometric" : "quadratic");
  }
  if (part->second & (part->second - 1)) {
    text_fail(t, "the second order of a component is given by line, by geometric or by quadratic, not by two of them");
  }
  for (int k = 0; k < part->n_node && part->second == MODEL_LINE; k++) {
    const model_node *const node = &model.node[part->node + k];
    if (!node->line && model_moves(node, part->n_mode)) {
      text_fail(t, "node %d moves, and is on no line", node->id);
    }
  }
}

/* The line of a beam: its length, the places on it, its bends. */
static void model_beam_check(text_file *t, model_part *part)
{
  fb_beam_desc *const beam = &part->beam;
  double length = (double)beam->length, before[3] = {0, 0, 0};
  memcpy(beam->position, part->position, sizeof part->position);
  memcpy(beam->attitude, part->attitude, sizeof part->attitude);
  if (beam->n_point > 0) {
    if (!part->has_elements) {
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
  if (!part->has_modes) {
    text_fail(t, "a beam wants a line modes");
  }
  if (part->modes.cubic && part->modes.basis == FB_BASIS_FUNCTIONS) {
    model_at(t, part, "cubic");
    text_fail(t, "cubic is of natural and component modes: functions have a degree");
  }
  for (int k = 0; k < beam->n_station; k++) {
    beam->station[k].x *= part->is_fraction[k] ? (fb_real)length : FB_R(1.0);
  }
  if (beam->n_station > 1 && fabs((double)beam->station[beam->n_station - 1].x - length) > 1e-5 * length) {
    text_fail(t, "the last station is at %.10g, the tip at %.10g", (double)beam->station[beam->n_station - 1].x,
              length);
  } else if (beam->n_station > 1 && beam->n_point == 0) {
    beam->station[beam->n_station - 1].x = beam->length;
  }
  for (int k = 0; k < model.n_mark; k++) {
    double *const x = model.mark[k].x;
    if (model.mark[k].part == part - model.part) {
      x[0] = x[0] < 0 ? length : x[0];
      if (x[0] > length * (1 + 1e-5)) {
        text_fail(t, "a node at %.10g is beyond the tip at %.10g", x[0], length);
      }
    }
  }
}

/* Refuses a word that was there before, but for those of which there may be many. */
static void model_once(text_file *t, text_words *seen, const char *word)
{
  static const char *const many[] = {"point",     "lump",     "load", "node",      "taper", "shape",     "mark",
                                     "quadratic", "boundary", "beam", "component", "line",  "geometric", "rotor"};
  for (int k = 0; k < (int)(sizeof many / sizeof many[0]); k++) {
    if (strcmp(word, many[k]) == 0) {
      text_note(t, seen, word);
      return;
    }
  }
  text_once(t, seen, word);
}

/* One more part, of which nothing is known yet. */
static model_part *model_begin_part(model_kind kind)
{
  model_part *const part = &model.part[model.n_part++];
  part->kind = kind;
  part->beam.n_element = FB_MAX_ELEMENTS / 2;
  part->node = model.n_node;
  part->pair = model.n_pair;
  return part;
}

/* Of a body of that kind nothing is known yet. */
static void model_begin(model_kind kind)
{
  clear_memory(&model, sizeof model);
  fb_shape_init(&model_shape, 0);
  strcpy(model.name, "flexible_body");
  model.kind = kind;
  model.level.effects = kind == MODEL_RIGID ? FB_EFFECTS_RIGID : FB_EFFECTS_FULL;
  if (kind == MODEL_BEAM || kind == MODEL_COMPONENT) {
    model_begin_part(kind);
  }
}

/* A line of a part that begins with that word. */
static void model_part_line(text_file *t, model_part *part, const char *word)
{
  if (strcmp(word, "position") == 0) {
    text_reals(t, word, part->position, 3);
    text_end_of_line(t);
  } else if (strcmp(word, "attitude") == 0) {
    double quat[4] = {0};
    fb_real unit[4];
    model_attitude(t, quat);
    for (int i = 0; i < 4; i++) {
      unit[i] = part->attitude[i] = (fb_real)quat[i];
    }
    if (!t->failed && fb_quat_normalize(unit) != FB_OK) {
      text_fail(t, "an attitude must not be zero");
    }
    text_end_of_line(t);
  } else {
    (part->kind == MODEL_BEAM ? model_beam_line : model_component_line)(t, part, word);
  }
}

/* What only all lines of a part tell. */
static void model_part_check(text_file *t, model_part *part)
{
  if (!t->failed) {
    (part->kind == MODEL_BEAM ? model_beam_check : model_component_check)(t, part);
  }
}

/* The root of a beam on a hub is held by it. */
static void model_root_check(text_file *t, model_part *part)
{
  const fb_root root = part->beam.root;
  if (root == FB_ROOT_FREE || (root == FB_ROOT_PINNED && part->modes.basis == FB_BASIS_MODES)) {
    model_at(t, part, "root");
    text_fail(t, root == FB_ROOT_FREE ? "a beam with a free root is not held by the hub: root clamped"
                                      : "modes of a pinned root leave out its rotation: root clamped, or functions");
  }
}

/* Nodes that the part has like another one: NAME of its own, a point, and the name there. */
static void model_like_name(text_file *t, char to[TEXT_NAME], const model_part *part, const char *name)
{
  char both[2 * TEXT_NAME];
  snprintf(both, sizeof both, "%s.%s", part->name, name);
  if (name[0] && strlen(both) >= TEXT_NAME) {
    text_fail(t, "the name of a node has %d characters at most: %s", TEXT_NAME - 1, both);
  } else if (name[0]) {
    strcpy(to, both);
  }
}

static void model_like_nodes(text_file *t, model_part *part, const model_part *other)
{
  const int from = (int)(other - model.part), shift = model.n_node - other->node;
  for (int k = 0, n = model.n_mark; k < n; k++) {
    if (model.mark[k].part == from && model.n_mark < FB_MAX_NODES) {
      model.mark[model.n_mark].part = (int)(part - model.part);
      memcpy(model.mark[model.n_mark].x, model.mark[k].x, sizeof model.mark[k].x);
      model_like_name(t, model.mark[model.n_mark++].name, part, model.mark[k].name);
    }
  }
  if (model.n_mark == FB_MAX_NODES || model.n_node + other->n_node > MODEL_NODES ||
      model_count_modes() > FB_MAX_MODES) {
    text_fail(t, "more than %d nodes, %d of components or %d of their modes", FB_MAX_NODES - 1, MODEL_NODES,
              FB_MAX_MODES);
    return;
  }
  part->node = model.n_node;
  part->pair = model.n_pair;
  for (int k = 0; k < other->n_node; k++) {
    model_node *const node = &model.node[model.n_node++];
    *node = model.node[other->node + k];
    node->from += node->from >= 0 ? shift : 0;
    model_like_name(t, node->name, part, model.node[other->node + k].name);
  }
  for (int k = 0; k < other->n_pair; k++) {
    model.pair[model.n_pair++] = model.pair[other->pair + k];
  }
}

/* like OTHER X Y Z [ATTITUDE]: the same part at another place. */
static void model_like(text_file *t, model_part *part)
{
  const char *const word = text_word(t);
  const model_part own = *part, *other = model.part;
  double quat[4] = {0};
  while (other < part && word && (strcmp(other->name, word) != 0 || other->kind != part->kind)) {
    other++;
  }
  if (other == part || !word) {
    text_fail(t, "no %s before it has the name %s", model_kinds[part->kind], word ? word : "(missing)");
    return;
  }
  *part = *other;
  memcpy(part->name, own.name, sizeof own.name);
  memset(part->is_fraction, 0, sizeof part->is_fraction); /* places are known */
  part->line = own.line;
  text_reals(t, "position", part->position, 3);
  if (text_more(t)) {
    model_attitude(t, quat);
  }
  for (int i = 0; i < 4; i++) {
    part->attitude[i] = (fb_real)quat[i];
  }
  text_end_of_line(t);
  if (!t->failed) {
    model_like_nodes(t, part, other);
  }
  model_part_check(t, part);
}

/* beam NAME or component NAME, the lines of such a description, end; or NAME like OTHER X Y Z [ATTITUDE] */
static void model_block(text_file *t, model_kind kind)
{
  model_part *part;
  const int begin = t->line;
  int last;
  if (model.n_part == FB_MAX_PARTS) {
    text_fail(t, "more than %d parts", FB_MAX_PARTS);
    return;
  }
  part = model_begin_part(kind);
  part->line = begin;
  text_name(t, "a part", part->name);
  for (int k = 0; k < model.n_part - 1; k++) {
    if (strcmp(model.part[k].name, part->name) == 0) {
      text_fail(t, "two parts have the name %s", part->name);
    }
  }
  if (text_take(t, "like")) {
    model_like(t, part);
    return;
  }
  text_end_of_line(t);
  text_begin(t, model_kinds[kind], part->name);
  while (text_within(t)) {
    const char *const word = text_word(t);
    model_once(t, &part->seen, word);
    if (strcmp(word, "damping") == 0) {
      part->n_damping = model_damping(t, part->zeta);
      text_end_of_line(t);
    } else {
      model_part_line(t, part, word);
    }
  }
  last = t->line;
  t->line = begin; /* what is missing has no line of its own */
  model_part_check(t, part);
  model_root_check(t, part);
  t->line = last;
}

/* A line that begins with that word. */
static void model_line(text_file *t, const char *word)
{
  const int parts = model.kind == MODEL_PARTS;
  model_once(t, &model.seen, word);
  if (model_common(t, word)) {
    return;
  }
  if (!parts && model.kind != MODEL_RIGID) {
    model_part_line(t, &model.part[0], word);
  } else if (strcmp(word, "node") == 0) {
    model_hub_node(t);
  } else if (parts && strcmp(word, "beam") == 0) {
    model_block(t, MODEL_BEAM);
  } else if (parts && strcmp(word, "component") == 0) {
    model_block(t, MODEL_COMPONENT);
  } else {
    text_fail(t, "no such word for a %s: %s", parts ? "body of parts (hub, beam, component, node)" : "rigid body",
              word);
  }
}

/* Lines that come may say again what was said, as lines of another file. */
static inline void model_forget_lines(void)
{
  model.seen.n = 0;
  for (int k = 0; k < model.n_part; k++) {
    model.part[k].seen.n = model.part[k].line = 0;
  }
  for (int k = 0; k < model.level.n_rotor; k++) {
    model.rotor[k].text.line = 0;
  }
}

/* Where a rotor sits, by name or number among the nodes in the order of the body: the hub's, then those of each part;
   *namesakes: nodes of that name. */
static int model_find_node(int *namesakes, const char *name)
{
  int n = 0, at = strcmp(name, "origin") == 0 || !name[0] ? 0 : -1;
  char *end;
  const long number = strtol(name, &end, 10);
  *namesakes = 0;
  for (int part = -1; part < model.n_part; part++) {
    for (int k = 0; k < model.n_mark; k++) {
      const int is = model.mark[k].part == part && strcmp(model.mark[k].name, name) == 0 && name[0];
      n += model.mark[k].part == part;
      at = is ? n : at;
      *namesakes += is;
    }
    for (int k = 0; part >= 0 && k < model.part[part].n_node; k++) {
      const model_node *const node = &model.node[model.part[part].node + k];
      const int is = node->marked && strcmp(node->name, name) == 0 && name[0];
      n += node->marked > 0;
      at = is ? n : at;
      *namesakes += is;
    }
  }
  return at < 0 && end != name && !*end && number >= 0 && number <= n ? (int)number : at;
}

static void model_rotor_nodes(text_file *t)
{
  for (int k = 0; k < model.level.n_rotor && !t->failed; k++) {
    int namesakes;
    const int at = model_find_node(&namesakes, model.rotor[k].node), line = t->line, own = model.rotor[k].text.line;
    model.level.rotor[k].node = at;
    t->line = own > 0 ? own : line;
    if (at < 0 || namesakes > 1) {
      text_fail(t, "rotor %s: %s the name%s %s", model.rotor[k].text.name, at < 0 ? "no node has" : "two nodes have",
                at < 0 ? " or number" : "", model.rotor[k].node);
    }
    t->line = line;
  }
}

/* Remembers the first of what may be a mistake, with the line of that word of a part (NULL: of the whole). */
static void model_warn(model_part *part, const char *word, const char *what, double number)
{
  const int line = text_seen(model_seen(part), word);
  char text[sizeof model.warning - 24];
  if (!model.warning[0]) {
    snprintf(text, sizeof text, what, number);
    if (line > 0) {
      snprintf(model.warning, sizeof model.warning, "line %d: ", line);
    }
    strcat(model.warning, text);
  }
}

static void model_warn_damping(model_part *part, const double *zeta, int n)
{
  for (int k = 0; k < n; k++) {
    if (zeta[k] > 1) {
      model_warn(part, "damping", "a damping ratio of %g: such a mode does not swing (half a percent is 0.005)",
                 zeta[k]);
    }
  }
}

/* Does the line of a component turn back at a node by more than 90 degrees? */
static int model_is_folded(const model_node *node)
{
  const model_node *const at = node->from >= 0 ? &model.node[node->from] : NULL;
  const double *const before = !at ? NULL : at->from >= 0 ? model.node[at->from].x : at->rooted ? at->root : NULL;
  double turn = 0, size = 0;
  for (int i = 0; i < 3 && before; i++) {
    turn += (node->x[i] - at->x[i]) * (at->x[i] - before[i]);
    size += fabs(node->x[i] - at->x[i]) * fabs(at->x[i] - before[i]);
  }
  return turn < -1e-9 * size;
}

/* The first station of a beam that is of no material in SI units. */
static void model_doubt(const model_part *part)
{
  const fb_beam_desc *const beam = &part->beam;
  const size_t told = strlen(model.doubt);
  char text[SECTION_DOUBT];
  double length = beam->n_point > 0 ? 0 : (double)beam->length;
  for (int k = 1; k < beam->n_point; k++) {
    const fb_real *const a = beam->point[k - 1], *const b = beam->point[k];
    length += hypot(hypot((double)(b[0] - a[0]), (double)(b[1] - a[1])), (double)(b[2] - a[2]));
  }
  for (int k = 0; k < beam->n_station; k++) {
    const fb_section *const s = &beam->station[k];
    const section_figures figures = {(double)s->mass, (double)s->EA,  (double)s->GJ, (double)s->EI_y,
                                     (double)s->EI_z, (double)s->i_y, (double)s->i_z};
    if (section_doubt(text, (double)s->x, length, &figures)) {
      snprintf(model.doubt + told, sizeof model.doubt - told, "%sline %d: %s%s%s", told ? "; " : "",
               part->station_line[k], part->name, part->name[0] ? ": " : "", text);
      return;
    }
  }
}

static void model_warn_all(void)
{
  double zeta[FB_MAX_MODES];
  for (int k = 0; k < FB_MAX_MODES; k++) {
    zeta[k] = (double)model.level.zeta[k];
  }
  model_warn_damping(NULL, zeta, model.n_damping);
  for (int p = 0; p < model.n_part; p++) {
    model_part *const part = &model.part[p];
    model_warn_damping(part, part->zeta, part->n_damping);
    model_doubt(part);
    for (int k = 0; k < part->n_node && part->second == MODEL_LINE; k++) {
      const model_node *const node = &model.node[part->node + k];
      if (model_is_folded(node)) {
        model_warn(part, "line", "at node %.0f a line turns back by more than 90 degrees: its nodes follow each other",
                   (double)model.node[node->from].id);
      }
    }
  }
}

/* What only the whole description tells. */
/* The root of a beam whose natural modes leave out how it moves there, else FB_ROOT_CLAMPED: modes by static deflections
   have it among their coordinates, of lines of large deflection the curvatures alone count. */
static inline fb_root model_loose_root(void)
{
  const model_part *const part = &model.part[0];
  const int leaves_out = model.kind == MODEL_BEAM && part->modes.basis == FB_BASIS_MODES &&
                         part->modes.n_boundary == 0 && !(model.level.effects & FB_EFFECT_LARGE_DEFLECTION);
  return leaves_out ? part->beam.root : FB_ROOT_CLAMPED;
}

/* A beam that is the whole body. */
static void model_loose_check(text_file *t)
{
  const double *const J = model.hub_inertia;
  const int turns = fabs(J[0]) + fabs(J[1]) + fabs(J[2]) > 0;
  const fb_root root = model_loose_root();
  if (root == FB_ROOT_FREE && (model.hub || model.level.base != FB_BASE_FREE)) {
    model_at(t, &model.part[0], "root");
    text_fail(t,
              "modes of a free root are those of a beam that flies alone, held by no %s: its hub is a line "
              "`lump 0 ..`, or root clamped",
              model.hub ? "hub" : "base");
  } else if (root == FB_ROOT_PINNED && ((model.hub && turns) || model.level.base == FB_BASE_PRESCRIBED)) {
    model_at(t, &model.part[0], "root");
    text_fail(t, "modes of a pinned root leave out how it turns against its %s: root clamped",
              model.hub && turns ? "hub" : "base");
  }
}

static void model_check(text_file *t)
{
  model_rotor_nodes(t);
  model_effects_check(t);
  if (!t->failed && (model.kind == MODEL_BEAM || model.kind == MODEL_COMPONENT)) {
    model_part_check(t, &model.part[0]);
  }
  if (!t->failed) {
    model_loose_check(t);
  }
  if (!t->failed) {
    model_quadratic_check(t);
  }
  if (!t->failed) {
    model_warn_all();
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

/* Has a component second-order data for this spin (NULL: for any)? A pair stiffens by -w^T Gamma^chi w (E8.51). */
static inline int model_part_stiffens(const model_part *part, const double w[3])
{
  double most = 0, here = 0;
  for (int k = part->pair; k < part->pair + part->n_pair; k++) {
    const double *const G = model.pair[k].gamma;
    double by = 0;
    for (int i = 0; i < 9; i++) {
      by += w ? w[i / 3] * w[i % 3] * G[i] : 0;
      most = fmax(most, fabs(G[i]));
    }
    here = fmax(here, fabs(by));
  }
  return part->second == MODEL_LINE || (part->second != 0 && (!w || here > 1e-9 * most));
}

/* Tells of the first component that a spin (NULL: any) bends and does not stiffen, as its description has no data for that;
   0: there is none. Effects that leave stiffening out where the data are there are a choice, of which nothing is told. */
static inline int model_lacks_stiffening(char text[160], const double spin[3])
{
  const double size = spin ? sqrt(spin[0] * spin[0] + spin[1] * spin[1] + spin[2] * spin[2]) : 1;
  const double w[3] = {spin ? spin[0] / size : 0, spin ? spin[1] / size : 0, spin ? spin[2] / size : 0};
  for (int k = 0; k < model.n_part && (model.level.effects & FB_EFFECT_SPIN_COUPLING); k++) {
    const model_part *const part = &model.part[k];
    if (part->kind == MODEL_COMPONENT && !model_part_stiffens(part, spin ? w : NULL)) {
      snprintf(text, 160,
               "%s has no second-order data%s: spinning does not stiffen it, its frequencies are too low, it "
               "may seem unstable",
               part->name[0] ? part->name : "the component", part->second ? " for this axis" : "");
      return 1;
    }
  }
  return 0;
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
  if (!t.failed && model.warning[0]) {
    fprintf(stderr, "%s: %s: warning: %s\n", program, file, model.warning);
  }
  if (!t.failed && model.doubt[0]) {
    fprintf(stderr, "%s: %s: warning: %s\n", program, file, model.doubt);
  }
  text_close(&t);
  return !t.failed;
}

/* One more node of the shape, which was added before: whose it is, and its name. */
static void model_note_node(int at, int part, const char *name)
{
  model.node_part[at] = part;
  strcpy(model.node_name[at], name);
}

/* Axes of a component to those of the body. */
static void model_axes(const model_part *part, fb_real R[9])
{
  fb_real quat[4];
  memcpy(quat, part->attitude, sizeof quat);
  if (fb_quat_normalize(quat) != FB_OK) { /* none was given */
    quat[0] = FB_R(1.0);
  }
  fb_quat_to_mat33(R, quat);
}

typedef struct model_target { /* where the modes of a component go: coordinates from `first` on of n, each scaled */
  const model_part *part;
  const fb_real *scale;
  int first, n;
} model_target;

typedef struct model_moving { /* a component's node in axes of the body */
  fb_real r[3], inertia[6], psi[3 * FB_MAX_MODES], theta[3 * FB_MAX_MODES];
} model_moving;

static void model_place_node(model_moving *out, const model_target *to, const model_node *node)
{
  const model_part *const part = to->part;
  fb_real R[9], back[9], J[9], half[9], own[3];
  model_axes(part, R);
  memset(out, 0, sizeof *out);
  for (int a = 0; a < part->n_mode; a++) {
    fb_real u[3], turn[3];
    for (int i = 0; i < 3; i++) {
      u[i] = to->scale[a] * (fb_real)node->shape[6 * a + i];
      turn[i] = to->scale[a] * (fb_real)node->shape[6 * a + 3 + i];
    }
    fb_mat33_mul_vec3(out->psi + 3 * (to->first + a), R, u);
    fb_mat33_mul_vec3(out->theta + 3 * (to->first + a), R, turn);
  }
  for (int i = 0; i < 9; i++) {
    static const int at[9] = {0, 3, 4, 3, 1, 5, 4, 5, 2};
    J[i] = (fb_real)node->inertia[at[i]];
    own[i % 3] = (fb_real)node->x[i % 3];
    back[i] = R[3 * (i % 3) + i / 3];
  }
  fb_mat33_mul_vec3(out->r, R, own);
  fb_mat33_mul(half, R, J);
  fb_mat33_mul(J, half, back);
  for (int i = 0; i < 3; i++) {
    out->r[i] += part->position[i];
    out->inertia[i] = J[4 * i];
    out->inertia[3 + i] = J[i < 2 ? 1 + i : 5];
  }
}

/* Fields of a node of a line, from those of the nodes before it; `known` are those of node *have, which is on the way
   where the nodes come in the order of their line. */
static fb_status model_fields(fb_fields *known, int *have, const model_target *to, int at)
{
  static int way[MODEL_NODES];
  model_moving m;
  int steps = 0;
  fb_status status = FB_OK;
  for (int k = at; k >= 0 && k != *have; k = model.node[k].from) {
    way[steps++] = k;
  }
  while (steps > 0 && status == FB_OK) {
    const model_node *const node = &model.node[way[--steps]];
    const fb_fields *from = node->from >= 0 || node->rooted ? known : NULL;
    if (node->rooted) {
      model_node root;
      memset(&root, 0, sizeof root);
      memcpy(root.x, node->root, sizeof root.x);
      model_place_node(&m, to, &root);
      status = fb_fields_init(known, &model_shape, NULL, m.r, m.psi, m.theta);
    }
    model_place_node(&m, to, node);
    status = status ? status : fb_fields_init(known, &model_shape, from, m.r, m.psi, node->straight ? NULL : m.theta);
  }
  *have = status == FB_OK ? at : -1;
  return status;
}

/* Adds the nodes of a component to a shape; whole: with the second order along lines, and marked ones as nodes of the
   body. */
static fb_status model_add_nodes(const model_target *to, int whole, const char **what)
{
  static char at_node[32];
  static fb_fields known;
  fb_status status = FB_OK;
  int have = -1;
  for (int k = to->part->node; k < to->part->node + to->part->n_node && status == FB_OK; k++) {
    const model_node *const node = &model.node[k];
    const int line = whole && node->line;
    model_moving m;
    int at;
    status = line ? model_fields(&known, &have, to, k) : FB_OK;
    model_place_node(&m, to, node);
    if (status == FB_OK) {
      status = line ? fb_shape_add_field_lump(&model_shape, &known, (fb_real)node->mass, m.inertia)
                    : fb_shape_add_lump(&model_shape, (fb_real)node->mass, m.r, m.inertia, m.psi, m.theta);
    }
    if (status == FB_OK && whole && node->marked) {
      status = line ? fb_shape_add_field_node(&model_shape, &at, &known)
                    : fb_shape_add_node(&model_shape, &at, m.r, m.psi, m.theta);
      if (status == FB_OK) {
        model_note_node(at, (int)(to->part - model.part), node->name);
      }
    }
    if (status != FB_OK) {
      snprintf(at_node, sizeof at_node, "node %d", node->id);
      *what = at_node;
    }
  }
  return status;
}

/* Adds the second-order displacement of a component: with r = p + R r', chi = R chi'
   p^chi = R p', h^chi = R h' + p x R p', Gamma^chi = R Gamma' R^T - (R p')^ p^. */
static fb_status model_add_pairs(const model_part *part, const fb_real *scale)
{
  fb_real R[9], back[9];
  fb_status status = FB_OK;
  model_axes(part, R);
  for (int i = 0; i < 9; i++) {
    back[i] = R[3 * (i % 3) + i / 3];
  }
  for (int k = part->pair; k < part->pair + part->n_pair && status == FB_OK; k++) {
    const int a = model.pair[k].a, b = model.pair[k].b;
    const fb_real s = scale[a] * scale[b];
    fb_real own[9], p[3], h[3], gamma[9], half[9], across[3], along;
    for (int i = 0; i < 9; i++) {
      own[i] = s * (fb_real)model.pair[k].gamma[i];
      p[i % 3] = s * (fb_real)model.pair[k].p[i % 3];
      h[i % 3] = s * (fb_real)model.pair[k].h[i % 3];
    }
    fb_mat33_mul(half, R, own);
    fb_mat33_mul(gamma, half, back);
    fb_mat33_mul_vec3(own, R, p);
    fb_mat33_mul_vec3(own + 3, R, h);
    fb_vec3_cross(across, part->position, own);
    along = fb_vec3_dot(part->position, own);
    for (int i = 0; i < 9; i++) {
      gamma[i] += (i % 4 == 0 ? along : FB_R(0.0)) - part->position[i / 3] * own[i % 3];
    }
    for (int i = 0; i < 3; i++) {
      h[i] = own[3 + i] + across[i];
    }
    status = fb_shape_add_pair(&model_shape, part->first + a, part->first + b, own, h, gamma);
  }
  return status;
}

/* The shape of a component: modes scaled to unit modal mass, so that K is omega^2. */
static fb_status model_component_shape(model_part *part, const char **what)
{
  const int n = model_shape.n;
  const model_target to = {part, model_scale[part - model.part], part->first, n};
  fb_status status = model_add_nodes(&to, 1, what);
  for (int a = 0; a < part->n && status == FB_OK; a++) {
    const fb_real w = (fb_real)(2.0 * model_pi * part->frequency[a]);
    model_shape.K[(part->first + a) * (n + 1)] = w * w;
  }
  return status ? status : model_add_pairs(part, model_scale[part - model.part]);
}

static fb_status model_beam_shape(const model_part *part, const char **what)
{
  const fb_beam *const beam = &model_beam[part - model.part];
  const fb_modes *const modes = &model_modes[part - model.part];
  fb_status status;
  *what = "its integrals";
  status = fb_shape_add_beam(&model_shape, part->first, beam, modes);
#if FB_WITH_NONLINEAR_STRAIN
  if (status == FB_OK && (model.level.effects & FB_EFFECT_NONLINEAR_STRAIN)) {
    *what = "its strain stations (they want EA, and `functions` with as many axial modes as bending ones)";
    status = fb_shape_add_beam_strain(&model_shape, part->first, beam, modes);
  }
#endif
  return status;
}

/* Nodes of the hub (part -1) or of a beam. */
static fb_status model_add_marks(int part, const char **what)
{
  fb_status status = FB_OK;
  for (int k = 0; k < model.n_mark && status == FB_OK; k++) {
    const fb_real none[3 * FB_MAX_MODES] = {0};
    const fb_real x[3] = {(fb_real)model.mark[k].x[0], (fb_real)model.mark[k].x[1], (fb_real)model.mark[k].x[2]};
    int at;
    if (model.mark[k].part != part) {
      continue;
    }
    *what = "a node";
    status = part < 0 ? fb_shape_add_node(&model_shape, &at, x, none, none)
                      : fb_shape_add_beam_node(&model_shape, &at, model.part[part].first, &model_beam[part],
                                               &model_modes[part], x[0]);
    if (status == FB_OK) {
      model_note_node(at, part, model.mark[k].name);
    }
  }
  return status;
}

/* Modes of a beam; those of the one before are kept, for a part or a body that is the same. */
static fb_status model_solve_beam(fb_modes *modes, const fb_beam *beam, const fb_modes_desc *desc)
{
  static struct {
    int is_there;
    fb_beam beam;
    fb_modes_desc desc;
    fb_modes modes;
  } last;
  fb_status status = FB_OK;
  if (!last.is_there || memcmp(&last.beam, beam, sizeof *beam) != 0 || memcmp(&last.desc, desc, sizeof *desc) != 0) {
    last.beam = *beam;
    last.desc = *desc;
    status = fb_modes_solve(&last.modes, &model_modes_work, beam, desc);
    last.is_there = status == FB_OK;
  }
  *modes = last.modes;
  return status;
}

/* The coordinates of a part: modes of a beam, scales of a component's modes by their modal masses. */
static fb_status model_solve_part(model_part *part, const char **what)
{
  const int k = (int)(part - model.part);
  fb_real *const scale = model_scale[k];
  fb_status status;
  if (part->kind == MODEL_BEAM) {
    *what = "the beam";
    status = fb_beam_init(&model_beam[k], &part->beam);
    if (status == FB_OK) {
      *what = "its modes";
      status = model_solve_beam(&model_modes[k], &model_beam[k], &part->modes);
      part->n = model_modes[k].n;
    }
    return status;
  }
  *what = "the component";
  part->n = part->n_mode;
  for (int a = 0; a < part->n; a++) {
    scale[a] = FB_R(1.0);
  }
  status = fb_shape_init(&model_shape, part->n); /* built afresh later */
  if (status == FB_OK) {
    const model_target alone = {part, scale, 0, part->n};
    status = model_add_nodes(&alone, 0, what);
  }
  for (int a = 0; a < part->n && status == FB_OK; a++) {
    const fb_real m = model_shape.M[a * (part->n + 1)];
    status = m > FB_R(0.0) ? FB_OK : FB_ERR_SINGULAR;
    scale[a] = FB_R(1.0) / FB_SQRT(m);
  }
  return status;
}

/* Which part has a coordinate, and the how manieth it is there. */
static const model_part *model_part_of(int coordinate, int *own)
{
  int k = 0;
  while (k + 1 < model.n_part && coordinate >= model.part[k + 1].first) {
    k++;
  }
  *own = coordinate - model.part[k].first;
  return &model.part[k];
}

/* Kind of a coordinate's mode; FB_KIND_COUNT: a component's. */
static inline int model_mode_kind(int coordinate)
{
  int own;
  const model_part *const part = model_part_of(coordinate, &own);
  return part->kind == MODEL_BEAM ? (int)model_modes[part - model.part].kind[own] : FB_KIND_COUNT;
}

/* Modes by frequency, as fb_body_desc.zeta counts those of a general M: coordinate[k] is one that moves most in mode k.
   M and K of parts are blocks, so that a mode is that of one part. */
static fb_status model_modes_order(int *coordinate)
{
  fb_body_work *const w = &model_body_work;
  const int n = model_shape.n;
  fb_status status;
  memcpy(w->A, model_shape.K, (size_t)(n * n) * sizeof *w->A);
  memcpy(w->B, model_shape.M, (size_t)(n * n) * sizeof *w->B);
  status = fb_eig_gen_solve(w->d, w->X, w->A, w->B, n);
  for (int k = 0; k < n && status == FB_OK; k++) {
    coordinate[k] = 0;
    for (int a = 1; a < n; a++) {
      coordinate[k] = FB_FABS(w->X[k * n + a]) > FB_FABS(w->X[k * n + coordinate[k]]) ? a : coordinate[k];
    }
  }
  return status;
}

/* Ratio of a part's mode. */
static double model_part_zeta(const model_part *part, int mode)
{
  return part->n_damping > 0 ? part->zeta[mode] : model.zeta;
}

/* Damping by parts, to the ratios of the body: of its coordinates, or of its modes by frequency where they are not
   normalized, which who selects among coordinates has to refuse. */
static fb_status model_damp_parts(const char **what)
{
  const fb_body_desc plain = {.effects = FB_EFFECTS_LINEAR, .base = FB_BASE_PRESCRIBED};
  int coordinate[FB_MAX_MODES], taken[FB_MAX_PARTS] = {0}, own = 0, general;
  fb_status status;
  model.by_frequency = 0;
  for (int k = 0; k < model.n_part; k++) {
    const model_part *const part = &model.part[k];
    if (part->n_damping > 1 && part->n_damping != part->n) {
      model.built = k;
      *what = "damping wants one ratio, or as many as the part has modes";
      return FB_ERR_VALUE;
    }
    own |= part->n_damping > 0;
  }
  if (!own) {
    return FB_OK;
  }
  *what = "damping of parts";
  status = fb_body_init(&model_body, &model_body_work, &model_shape, &plain); /* tells whether modes are normalized */
  for (int k = 0; k < model_shape.n; k++) {
    coordinate[k] = k;
  }
  general = !(model_body.unit_mass && model_body.K.n_term == 0);
  if (status == FB_OK && general) {
    status = model_modes_order(coordinate);
  }
  for (int k = 0; k < model_shape.n && status == FB_OK; k++) {
    const model_part *const part = model_part_of(coordinate[k], &own);
    const int mode = taken[part - model.part]++;
    model.level.zeta[k] = (fb_real)model_part_zeta(part, mode);
    model.by_frequency |= general && fabs((double)(model.level.zeta[k] - model.level.zeta[0])) > 0;
  }
  return status;
}

/* The shape of what was read. */
static fb_status model_shape_of_parts(const char **what)
{
  int n = 0;
  fb_status status = FB_OK;
  fb_real center[3], inertia[6];

  /* coordinates of the parts, one part after the other */
  for (int k = 0; k < model.n_part && status == FB_OK; k++) {
    model.part[k].first = n;
    model.built = k;
    status = model_solve_part(&model.part[k], what);
    n += model.part[k].n;
  }
  if (status == FB_OK) {
    model.built = -1;
    *what = "the modes of all parts together";
    status = fb_shape_init(&model_shape, n);
  }

  /* parts, and the hub */
  status = status ? status : model_add_marks(-1, what);
  for (int k = 0; k < model.n_part && status == FB_OK; k++) {
    model_part *const part = &model.part[k];
    model.built = k;
    status = part->kind == MODEL_BEAM ? model_beam_shape(part, what) : model_component_shape(part, what);
    status = status ? status : model_add_marks(k, what);
  }
  if (status == FB_OK) {
    model.built = -1;
  }
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
  return status ? status : model_damp_parts(what);
}

/* Is a beam with natural modes, which are those of rest? */
static int model_part_rests(const model_part *part)
{
  return part->kind == MODEL_BEAM && part->modes.basis == FB_BASIS_MODES && !(FB_FABS(part->modes.spin) > 0) &&
         !(FB_FABS(part->modes.preload.spin) > 0);
}

static inline int model_rests(void)
{
  int rests = 0;
  for (int k = 0; k < model.n_part; k++) {
    rests |= model_part_rests(&model.part[k]);
  }
  return rests;
}

/* Shapes such modes for a spin [rad/s], the root so far [m] from its axis, as the word `spin` does. */
static inline void model_spin_modes(double spin, double radius)
{
  for (int k = 0; k < model.n_part; k++) {
    if (model_part_rests(&model.part[k])) {
      model.part[k].modes.spin = (fb_real)spin;
      model.part[k].modes.spin_radius = (fb_real)radius;
    }
  }
}

/* Builds the shape of what was read; on failure *what says at which part. */
static fb_status model_build_shape(const char **what)
{
  static char of_part[TEXT_NAME + 128];
  const fb_status status = model_shape_of_parts(what);
  const model_part *const part = &model.part[model.built < 0 ? 0 : model.built];
  if (status != FB_OK && model.built >= 0 && part->name[0]) {
    snprintf(of_part, sizeof of_part, "%s %s, %s", model_kinds[part->kind], part->name, *what);
    *what = of_part;
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
