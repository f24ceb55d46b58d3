/* elastodyn - a blade of OpenFAST (ElastoDyn's blade file: span fraction, twist, mass and stiffness per length) becomes
   a beam description for `reduce`. Columns are found by their names; adjustment factors and damping are applied.
   Exit: 0 well, 2 bad options or input. */
#define PROGRAM "elastodyn"
#include "../common/options.h"
#include "../common/output.h"
#include "../common/text.h"
#include "words.h"

static const char help[] =
    "elastodyn - from ElastoDyn's blade file to a beam description\n"
    "usage: flexbeam elastodyn FILE --length L [options] > blade.txt\n"
    "  --length L      [m] of the blade, root to tip (the turbine's TipRad - HubRad)\n"
    "  --hub-radius R  [m] of the root (0)\n"
    "  --rpm N         the modes are shaped for this speed (0: for rest)\n"
    "  --modes F,E     flap and edge modes to keep (3,3)\n"
    "  --help          this text\n"
    "z is out of the rotor plane (flap), x along the span. The file has no GJ, EA and no "
    "offsets: the blade is rigid in twist\n"
    "and stretch. Damping is the mean of the file's three ratios; its tuners and mode shapes are not used.\n"
    "Then: flexbeam reduce blade.txt --out blade.h\n";

#define MAX_STATIONS 200
static struct blade {
  int stations;
  double mass_factor, flap_factor, edge_factor, damping[3]; /* flap 1, flap 2, edge 1: part of critical */
  double x[MAX_STATIONS], twist[MAX_STATIONS], mass[MAX_STATIONS], flap[MAX_STATIONS], edge[MAX_STATIONS];
} blade;

/* `value NAME - text`: takes the value if the line is that of name. */
static int take(text_file *t, const char *name, double *value)
{
  char word[64], key[64];
  char *end;
  if (sscanf(t->buffer, "%63s %63s", word, key) != 2 || strcmp(key, name) != 0) {
    return 0;
  }
  *value = strtod(word, &end);
  if (*end || !isfinite(*value)) {
    text_fail(t, "%s is not a number: %s", name, word);
  }
  return 1;
}

/* The table: names, units, then as many rows as the head of the file says. */
static void read_table(text_file *t)
{
  static const char *const name[5] = {"BlFract", "StrcTwst", "BMassDen", "FlpStff", "EdgStff"};
  int column[5] = {-1, -1, -1, -1, -1}, columns = 0;
  const char *word;
  while ((word = text_word(t)) != NULL) {
    for (int k = 0; k < 5; k++) {
      column[k] = strcmp(word, name[k]) == 0 ? columns : column[k];
    }
    columns++;
  }
  for (int k = 0; k < 5; k++) {
    if (column[k] < 0) {
      text_fail(t, "there is no column %s", name[k]);
      return;
    }
  }
  if (!text_line(t)) {
    text_fail(t, "the units are missing");
  }
  for (int row = 0; row < blade.stations && !t->failed; row++) {
    double *const to[5] = {&blade.x[row], &blade.twist[row], &blade.mass[row], &blade.flap[row], &blade.edge[row]};
    if (!text_line(t)) {
      text_fail(t, "%d stations are announced, %d are there", blade.stations, row);
      return;
    }
    for (int c = 0; c < columns; c++) {
      char what[64];
      double x;
      snprintf(what, sizeof what, "row %d of %d, column %d", row + 1, blade.stations, c + 1);
      x = text_number(t, what);
      for (int k = 0; k < 5; k++) {
        *to[k] = column[k] == c ? x : *to[k];
      }
    }
    text_end_of_line(t);
    if (!t->failed && (row == 0 ? fabs(blade.x[0]) > 0 : blade.x[row] <= blade.x[row - 1])) {
      text_fail(t, row == 0 ? "BlFract must begin at 0" : "BlFract must ascend");
    }
    if (!t->failed && !(blade.mass[row] > 0 && blade.flap[row] > 0 && blade.edge[row] > 0)) {
      text_fail(t, "mass and stiffness must be greater than 0");
    }
  }
  if (!t->failed && fabs(blade.x[blade.stations - 1] - 1) > 1e-9) {
    text_fail(t, "BlFract must end at 1; %d rows were read, as NBlInpSt says", blade.stations);
  }
}

static int read_blade(const char *file)
{
  static const char *const damping[3] = {"BldFlDmp(1)", "BldFlDmp(2)", "BldEdDmp(1)"};
  text_file t;
  int table = 0;
  blade.mass_factor = blade.flap_factor = blade.edge_factor = 1;
  if (!text_open(&t, "elastodyn", file)) {
    return 0;
  }
  t.table = 1;
  while (!table && text_line(&t)) {
    double value;
    if (take(&t, "NBlInpSt", &value)) {
      if (!t.failed && !(value == floor(value) && value >= 2 && value <= MAX_STATIONS)) {
        text_fail(&t, "NBlInpSt must be a whole number from 2 to %d", MAX_STATIONS);
      }
      blade.stations = t.failed ? 0 : (int)value; /* a number beyond int has none */
    }
    (void)take(&t, "AdjBlMs", &blade.mass_factor);
    (void)take(&t, "AdjFlSt", &blade.flap_factor);
    (void)take(&t, "AdjEdSt", &blade.edge_factor);
    for (int k = 0; k < 3; k++) {
      if (take(&t, damping[k], &value)) {
        blade.damping[k] = 0.01 * value; /* percent */
        if (value < 0) {
          text_fail(&t, "%s is negative", damping[k]);
        }
      }
    }
    if (blade.mass_factor <= 0 || blade.flap_factor <= 0 || blade.edge_factor <= 0) {
      text_fail(&t, "an adjustment factor must be greater than 0");
    }
    table = strstr(t.buffer, "BlFract") != NULL;
    if (table && blade.stations == 0) {
      text_fail(&t, "NBlInpSt must come before the table");
    }
  }
  if (table) {
    read_table(&t);
  } else if (!t.failed) {
    t.line = 0;
    text_fail(&t, "has no table with the column BlFract");
  }
  text_close(&t);
  return !t.failed;
}

typedef struct conversion {
  double length, hub_radius, rpm, modes[2]; /* [m], [m], [rev/min], flap and edge */
} conversion;

static int conversion_option(void *target, const char *name, const char *text)
{
  conversion *const c = target;
  const number_option numbers[] = {
      {"--length", &c->length, 1e-3, 1e4}, {"--hub-radius", &c->hub_radius, 0, 1e4}, {"--rpm", &c->rpm, 0, 1e6}};
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
  const double mean = (blade.damping[0] + blade.damping[1] + blade.damping[2]) / 3.0;
  printf("# from %s by elastodyn; x along the span, z out of the rotor plane\nbeam\nname blade\nlength %.17g\n"
         "elements 12\nroot clamped\nposition %.17g 0 0\nmodes bend_y %g bend_z %g\n",
         file, c->length, c->hub_radius, c->modes[1], c->modes[0]);
  if (c->rpm > 0) {
    printf("spin %.17g %.17g\n", c->rpm * 2.0 * 3.14159265358979324 / 60.0, c->hub_radius);
  }
  printf("damping %.17g # mean of flap 1, flap 2, edge 1: %g %g %g\neffects full damping\nbase prescribed\nnode %.17g\n"
         "stations fraction twist_deg mass EI_y EI_z\n",
         mean, blade.damping[0], blade.damping[1], blade.damping[2], c->length);
  for (int k = 0; k < blade.stations; k++) {
    printf("%.17g %.17g %.17g %.17g %.17g\n", k + 1 < blade.stations ? blade.x[k] : 1.0, blade.twist[k],
           blade.mass[k] * blade.mass_factor, blade.flap[k] * blade.flap_factor, blade.edge[k] * blade.edge_factor);
  }
  printf("end\n");
}

int elastodyn_main(int argc, char **argv)
{
  const int named = argc > 1 && argv[1][0] != '-';
  conversion c = {0, 0, 0, {3, 3}};
  output_begin(PROGRAM);
  if (read_all(argc - named, argv + named, help, conversion_option, &c) != 0) {
    return 2;
  }
  if (!named || !(c.length > 0)) {
    return fail(named ? "--length is missing" : "a blade file is missing", "");
  }
  if (!read_blade(argv[1])) {
    return 2;
  }
  write_blade(argv[1], &c);
  return 0;
}
