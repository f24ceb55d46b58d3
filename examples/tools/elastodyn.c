/* elastodyn - a blade or tower of OpenFAST (ElastoDyn's file: span fraction, twist, mass and stiffness per length) becomes
   a beam description for `reduce`. Columns are found by their names; adjustment factors and damping are applied.
   With --shapes the other way: polynomials of the mode shapes of a description.
   Exit: 0 well, 2 bad options or input. */
#include "capacities.h"
#include "../../flexbeam.h"
#include "model.h"
#define PROGRAM "elastodyn"
#include "../common/options.h"
#include "../common/output.h"
#include "../common/text.h"
#include "words.h"
#include "elastodyn_shapes.h"

static const char help[] =
    "elastodyn - from ElastoDyn's blade or tower file to a beam description, and mode shapes back\n"
    "usage: flexbeam elastodyn FILE --length L [options] > blade.txt\n"
    "       flexbeam elastodyn DESCRIPTION --shapes blade > lines.txt\n"
    "  --length L      [m], root to tip (blade: the turbine's TipRad - HubRad; tower: TowerHt - TowerBsHt)\n"
    "  --hub-radius R  [m] of the root (0)\n"
    "  --rpm N         the modes are shaped for this speed (0: for rest)\n"
    "  --modes F,E     flap and edge modes to keep (3,3)\n"
    "  --shapes WHAT   blade or tower: polynomials of the mode shapes of a described beam (the text of reduce), as "
    "lines of\n"
    "                  ElastoDyn's files, at --rpm, with the root at --hub-radius. The rotor of a tower is a `lump` on "
    "its tip\n"
    "  --help          this text\n"
    "z is out of the rotor plane (flap, fore-aft), x along the span. ElastoDyn uses no GJ, EA and no "
    "offsets: the blade is rigid in twist\n"
    "and stretch. Damping is the mean of the file's ratios; its tuners and mode shapes are not used. Keys are\n"
    "written with parentheses or without: BldFlDmp(1), BldFlDmp1. One that is not there is told with what is assumed,\n"
    "one that is not known refused.\n"
    "Then: flexbeam reduce blade.txt --out blade.h\n";

#define MAX_STATIONS 200

/* Keys before the table, here without the parentheses that some files write: BldFlDmp(1) is BldFlDmp1. Of a tower flap is
   fore-aft, edge side to side. */
enum {
  STATIONS,
  FLAP_DAMPING_1,
  FLAP_DAMPING_2,
  EDGE_DAMPING_1,
  EDGE_DAMPING_2, /* towers */
  MASS_FACTOR,
  FLAP_FACTOR,
  EDGE_FACTOR,
  USED_KEYS,
  TUNER = USED_KEYS,
  MODES_INSIDE = TUNER + 4,
  KEYS
};
enum { FRACTION, TWIST, MASS, FLAP, EDGE, COLUMNS };

typedef struct file_format {
  const char *name, *heading, *key[KEYS], *listed, *column[COLUMNS], *other[14], *damped;
} file_format;

static const file_format formats[] = {
    {"blade",
     "BLADE PARAMETERS",
     {"NBlInpSt", "BldFlDmp1", "BldFlDmp2", "BldEdDmp1", NULL, "AdjBlMs", "AdjFlSt", "AdjEdSt", "FlStTunr1",
      "FlStTunr2", NULL, NULL, "CalcBMode"},
     "NBlInpSt, BldFlDmp(1), BldFlDmp(2), BldEdDmp(1), FlStTunr(1), FlStTunr(2), AdjBlMs, AdjFlSt, AdjEdSt",
     {"BlFract", "StrcTwst", "BMassDen", "FlpStff", "EdgStff"},
     {"AeroCent", "PitchAxis", "GJStff", "EAStff", "Alpha", "FlpIner", "EdgIner", "PrecrvRef", "PreswpRef", "FlpcgOf",
      "EdgcgOf", "FlpEAOf", "EdgEAOf", NULL},
     "flap 1, flap 2 and edge 1"},
    {"tower",
     "TOWER PARAMETERS",
     {"NTwInpSt", "TwrFADmp1", "TwrFADmp2", "TwrSSDmp1", "TwrSSDmp2", "AdjTwMa", "AdjFASt", "AdjSSSt", "FAStTunr1",
      "FAStTunr2", "SSStTunr1", "SSStTunr2", "CalcTMode"},
     "NTwInpSt, TwrFADmp(1), TwrFADmp(2), TwrSSDmp(1), TwrSSDmp(2), FAStTunr(1), FAStTunr(2), SSStTunr(1), "
     "SSStTunr(2), "
     "AdjTwMa, AdjFASt, AdjSSSt",
     {"HtFract", NULL, "TMassDen", "TwFAStif", "TwSSStif"},
     {"TwGJStif", "TwEAStif", "TwFAIner", "TwSSIner", "TwFAcgOf", "TwSScgOf", NULL},
     "fore-aft 1 and 2, side to side 1 and 2"}};

static struct blade {
  const file_format *format;
  int stations, given[KEYS]; /* given: line of each key, 0: it is not there */
  double value[KEYS];
  double x[MAX_STATIONS], twist[MAX_STATIONS], mass[MAX_STATIONS], flap[MAX_STATIONS], edge[MAX_STATIONS];
  char unused[256]; /* columns of the table */
} blade;

static double key_assumed(int k)
{
  return k >= MASS_FACTOR && k < MODES_INSIDE;
}

static int is_damping(int k)
{
  return k >= FLAP_DAMPING_1 && k <= EDGE_DAMPING_2;
}

/* A logical value as Fortran reads it: true, T, .FALSE. */
static int logical(const char *word)
{
  word += *word == '.';
  return *word && strchr("TtFf", *word) != NULL;
}

/* `value KEY - text` before the table. Lines of dashes are headings, and what stands above the first key is a title. */
static void take_key(text_file *t, int *begun)
{
  char word[64] = "", name[64] = "", plain[64];
  char *end;
  const int words = sscanf(t->buffer, "%63s %63s", word, name);
  int k = 0, n = 0;
  for (const char *c = name; *c; c++) {
    plain[n] = *c;
    n += *c != '(' && *c != ')';
  }
  plain[n] = 0;
  while (k < KEYS && !(blade.format->key[k] && strcmp(plain, blade.format->key[k]) == 0)) {
    k++;
  }
  if (k == KEYS) {
    *begun |= strstr(t->buffer, blade.format->heading) != NULL;
    if (*begun && strncmp(word, "--", 2) != 0 && strncmp(word, "==", 2) != 0) {
      text_fail(t, "%s is no key of a %s file: value and key are wanted, of %s", words == 2 ? name : word,
                blade.format->name, blade.format->listed);
    }
    return;
  }
  *begun = 1;
  if (blade.given[k] > 0) {
    text_fail(t, "%s is there twice, first in line %d", name, blade.given[k]);
  }
  blade.given[k] = t->line;
  blade.value[k] = strtod(word, &end);
  if (k == MODES_INSIDE ? !logical(word) : *end || end == word || !isfinite(blade.value[k])) {
    text_fail(t, k == MODES_INSIDE ? "%s is not True or False: %s" : "%s is not a number: %s", name, word);
  } else if (k == STATIONS &&
             !(blade.value[k] == floor(blade.value[k]) && blade.value[k] >= 2 && blade.value[k] <= MAX_STATIONS)) {
    text_fail(t, "%s must be a whole number from 2 to %d", blade.format->key[STATIONS], MAX_STATIONS);
  } else if (is_damping(k) && !(blade.value[k] >= 0 && blade.value[k] < 100)) {
    text_fail(t, blade.value[k] < 0 ? "%s is negative" : "%s is in percent of critical, less than 100", name);
  } else if (k >= MASS_FACTOR && k <= EDGE_FACTOR && !(blade.value[k] > 0)) {
    text_fail(t, "an adjustment factor must be greater than 0");
  }
}

/* Columns by their names. Those of older files that ElastoDyn reads and does not use are noted. */
static int read_columns(text_file *t, int column[COLUMNS])
{
  const file_format *const f = blade.format;
  int columns = 0, k;
  const char *word;
  for (k = 0; k < COLUMNS; k++) {
    column[k] = -1;
  }
  while ((word = text_word(t)) != NULL) {
    for (k = 0; k < COLUMNS && !(f->column[k] && strcmp(word, f->column[k]) == 0); k++) {
    }
    if (k < COLUMNS) {
      if (column[k] >= 0) {
        text_fail(t, "the column %s is there twice", word);
      }
      column[k] = columns;
    } else {
      const size_t n = strlen(blade.unused);
      for (k = 0; f->other[k] && strcmp(word, f->other[k]) != 0; k++) {
      }
      if (!f->other[k]) {
        char known[256] = "";
        for (k = 0; k < COLUMNS + 13; k++) {
          const char *const name = k < COLUMNS ? f->column[k] : f->other[k - COLUMNS];
          if (!name && k >= COLUMNS) {
            break;
          }
          snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s%s", name && known[0] ? ", " : "",
                   name && k == COLUMNS ? "and of older files " : "", name ? name : "");
        }
        text_fail(t, "%s is no column of a %s: %s", word, f->name, known);
      }
      snprintf(blade.unused + n, sizeof blade.unused - n, " %s", word);
    }
    columns++;
  }
  for (k = 0; k < COLUMNS && !t->failed; k++) {
    if (f->column[k] && column[k] < 0) {
      text_fail(t, "there is no column %s", f->column[k]);
    }
  }
  return columns;
}

/* The table: names, units, then as many rows as the head of the file says. */
static void read_table(text_file *t)
{
  int column[COLUMNS];
  const int columns = read_columns(t, column);
  if (!t->failed && !text_line(t)) {
    text_fail(t, "the units are missing");
  }
  for (int row = 0; row < blade.stations && !t->failed; row++) {
    double *const to[COLUMNS] = {&blade.x[row], &blade.twist[row], &blade.mass[row], &blade.flap[row],
                                 &blade.edge[row]};
    if (!text_line(t)) {
      text_fail(t, "%d stations are announced, %d are there", blade.stations, row);
      return;
    }
    for (int c = 0; c < columns; c++) {
      char what[64];
      double x;
      snprintf(what, sizeof what, "row %d of %d, column %d", row + 1, blade.stations, c + 1);
      x = text_number(t, what);
      for (int k = 0; k < COLUMNS; k++) {
        *to[k] = column[k] == c ? x : *to[k];
      }
    }
    text_end_of_line(t);
    if (!t->failed && (row == 0 ? fabs(blade.x[0]) > 0 : blade.x[row] <= blade.x[row - 1])) {
      text_fail(t, row == 0 ? "%s must begin at 0" : "%s must ascend", blade.format->column[FRACTION]);
    }
    if (!t->failed && !(blade.mass[row] > 0 && blade.flap[row] > 0 && blade.edge[row] > 0)) {
      text_fail(t, "mass and stiffness must be greater than 0");
    }
  }
  if (!t->failed && fabs(blade.x[blade.stations - 1] - 1) > 1e-9) {
    text_fail(t, "%s must end at 1; %d rows were read, as %s says", blade.format->column[FRACTION], blade.stations,
              blade.format->key[STATIONS]);
  }
}

/* A file that has a line with the number of stations of a tower is one of a tower; 0: it cannot be opened. */
static int find_format(const char *file)
{
  text_file t;
  blade.format = &formats[0];
  if (!text_open(&t, "elastodyn", file)) {
    return 0;
  }
  t.table = 1;
  while (text_line(&t)) {
    blade.format = strstr(t.buffer, formats[1].key[STATIONS]) ? &formats[1] : blade.format;
  }
  text_close(&t);
  return 1;
}

static int read_blade(const char *file)
{
  text_file t;
  int table = 0, begun = 0;
  memset(&blade, 0, sizeof blade);
  for (int k = 0; k < KEYS; k++) {
    blade.value[k] = key_assumed(k);
  }
  if (!find_format(file) || !text_open(&t, "elastodyn", file)) {
    return 0;
  }
  t.table = 1;
  while (!table && text_line(&t)) {
    table = strstr(t.buffer, blade.format->column[FRACTION]) != NULL;
    if (!table) {
      take_key(&t, &begun);
    } else if (blade.given[STATIONS] == 0) {
      text_fail(&t, "%s must come before the table", blade.format->key[STATIONS]);
    }
  }
  blade.stations = t.failed ? 0 : (int)blade.value[STATIONS];
  if (table) {
    read_table(&t);
  } else if (!t.failed) {
    t.line = 0;
    text_fail(&t, "has no table with the column %s", blade.format->column[FRACTION]);
  }
  text_close(&t);
  return !t.failed;
}

/* The mean of the damping ratios [%] that the format has; spread: the largest less the smallest. */
static double mean_damping(double *spread)
{
  double sum = 0, low = HUGE_VAL, high = 0;
  int n = 0;
  for (int k = FLAP_DAMPING_1; k <= EDGE_DAMPING_2; k++) {
    if (blade.format->key[k]) {
      sum += blade.value[k];
      low = fmin(low, blade.value[k]);
      high = fmax(high, blade.value[k]);
      n++;
    }
  }
  *spread = high - low;
  return sum / n;
}

/* What the file has not, with the value taken for it, and what of it goes nowhere: to stderr, or as comments. */
static void tell_blade(FILE *to, const char *begin, const char *file)
{
  const file_format *const f = blade.format;
  double spread;
  for (int k = 0; k < USED_KEYS; k++) {
    if (f->key[k] && blade.given[k] == 0) {
      fprintf(to, "%s%s: no %s: %g%s is assumed\n", begin, file, f->key[k], key_assumed(k), is_damping(k) ? " %" : "");
    }
  }
  (void)mean_damping(&spread);
  if (spread > 0) {
    fprintf(to, "%s%s: damping of %s differs, ", begin, file, f->damped);
    for (int k = FLAP_DAMPING_1; k <= EDGE_DAMPING_2 && f->key[k]; k++) {
      const int last = k == EDGE_DAMPING_2 || !f->key[k + 1];
      fprintf(to, "%s%g", k == FLAP_DAMPING_1 ? "" : last ? " and " : ", ", blade.value[k]);
    }
    fprintf(to, " %%: every mode has the mean\n");
  }
  for (int k = TUNER; k < MODES_INSIDE; k++) {
    if (blade.given[k] > 0 && (blade.value[k] > 1 || blade.value[k] < 1)) {
      fprintf(to, "%s%s:%d: %s %g is not used: it scales a mode of ElastoDyn\n", begin, file, blade.given[k], f->key[k],
              blade.value[k]);
    }
  }
  if (blade.unused[0]) {
    fprintf(to, "%s%s: columns that are not used:%s\n", begin, file, blade.unused);
  }
}

typedef struct conversion {
  double length, hub_radius, rpm, modes[2]; /* [m], [m], [rev/min], flap and edge */
  const shape_line *shapes;                 /* NULL: a file of ElastoDyn becomes a description */
} conversion;

static int conversion_option(void *target, const char *name, const char *text)
{
  conversion *const c = target;
  const number_option numbers[] = {
      {"--length", &c->length, 1e-3, 1e4}, {"--hub-radius", &c->hub_radius, 0, 1e4}, {"--rpm", &c->rpm, 0, 1e6}};
  if (strcmp(name, "--shapes") == 0) {
    c->shapes = strcmp(text, "blade") == 0 ? blade_shapes : strcmp(text, "tower") == 0 ? tower_shapes : NULL;
    return c->shapes ? 0 : fail("--shapes wants blade or tower", text);
  }
  if (strcmp(name, "--modes") == 0) {
    const double *const m = c->modes;
    return read_list(c->modes, 2, text) == 2 && m[0] == floor(m[0]) && m[1] == floor(m[1]) && m[0] >= 0 && m[1] >= 0 &&
                   m[0] + m[1] >= 1 && m[0] + m[1] <= 24
               ? 0
               : fail("--modes wants two whole numbers with a comma between, 1 to 24 together", text);
  }
  return read_number(numbers, 3, name, text);
}

static void write_blade(const char *file, const conversion *c)
{
  const int is_tower = blade.format == &formats[1];
  double spread;
  const double mean = 0.01 * mean_damping(&spread);
  printf("# from %s by elastodyn; x along the %s\n", file,
         is_tower ? "tower, z fore-aft" : "span, z out of the rotor plane");
  tell_blade(stdout, "# ", file);
  printf("beam\nname %s\nlength %.17g\n"
         "elements 12\nroot clamped\nposition %.17g 0 0\nmodes bend_y %g bend_z %g\n",
         blade.format->name, c->length, c->hub_radius, c->modes[1], c->modes[0]);
  if (c->rpm > 0) {
    printf("spin %.17g %.17g\n", c->rpm * 2.0 * model_pi / 60.0, c->hub_radius);
  }
  printf("damping %.17g # mean of %s\neffects full damping\nbase prescribed\nnode %.17g\n"
         "stations fraction twist_deg mass EI_y EI_z\n",
         mean, blade.format->damped, c->length);
  for (int k = 0; k < blade.stations; k++) {
    printf("%.17g %.17g %.17g %.17g %.17g\n", k + 1 < blade.stations ? blade.x[k] : 1.0, blade.twist[k],
           blade.mass[k] * blade.value[MASS_FACTOR], blade.flap[k] * blade.value[FLAP_FACTOR],
           blade.edge[k] * blade.value[EDGE_FACTOR]);
  }
  printf("end\n");
}

int elastodyn_main(int argc, char **argv)
{
  const int named = argc > 1 && argv[1][0] != '-';
  conversion c = {0, 0, 0, {3, 3}, NULL};
  output_begin(PROGRAM);
  if (read_all(argc - named, argv + named, help, conversion_option, &c) != 0) {
    return 2;
  }
  if (c.shapes && c.length > 0) {
    return fail("--length is that of a file of ElastoDyn, --shapes of a description, which has its own", "");
  }
  if (named && c.shapes) {
    return write_shapes(argv[1], c.shapes, c.rpm * 2.0 * model_pi / 60.0, c.hub_radius);
  }
  if (!named || !(c.length > 0)) {
    return fail(named ? "--length is missing" : "a blade file is missing", "");
  }
  if (!read_blade(argv[1])) {
    return 2;
  }
  tell_blade(stderr, PROGRAM ": ", argv[1]);
  write_blade(argv[1], &c);
  return 0;
}
