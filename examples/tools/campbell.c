/* campbell - frequencies of a rotating cantilever or blade over a range of spins, as CSV and picture.
   The beam turns steadily about z with its root at the hub radius; the modal model with the quadratic displacement
   field is brought to rest in the turning frame and linearized there: complex modes, with the gyroscopic terms.
   Exit: 0 well, 1 the model failed, 2 bad options or input. */
#define _POSIX_C_SOURCE 200809L
#include "capacities.h"
#include "../../flexbeam.h"
#include "../common/refusal.h"
#include "../common/boom.h"
#define PROGRAM "campbell"
#include "../common/options.h"
#include "../common/plot.h"
#include "../common/text.h"
#include "words.h"
#include "../common/output.h"

#define MAX_SPINS 256
#define MAX_MODES 8
static const double pi = 3.14159265358979324;

typedef struct options {
  double length, mass, ei, hub_radius, tip_mass, mass_factor; /* [m], [kg], [N m^2], [m], [kg] */
  double spin[MAX_SPINS];                                     /* [rad/s] */
  int spins, modes;
  const char *blade, *picture;
} options;

static const char help[] =
    "campbell - frequencies of a rotating cantilever or blade as CSV (spin [rad/s], kind, mode, omega [rad/s])\n"
    "usage: flexbeam campbell [options] > table.csv\n"
    "  --length L       [m] beam length (10)\n"
    "  --mass M         [kg] beam mass, uniform (12)\n"
    "  --ei EI          [N m^2] bending stiffness, the same in both planes (14004)\n"
    "  --hub-radius R   [m] distance of the root from the axis (0)\n"
    "  --spin A[,B,..]  [rad/s] spins about the axis (0,2,4,6; a blade: 0 to 20 rpm by 2)\n"
    "  --rpm A[,B,..]   the same in turns per minute\n"
    "  --modes K        modes per plane, 1..8 (4)\n"
    "  --tip-mass M     [kg] point mass at the tip (0)\n"
    "  --blade FILE     blade table (CSV with the columns span_fraction, twist_deg, mass [kg/m], EI_flap, EI_edge, GJ\n"
    "                   [N m^2], EA [N]) in place of --mass and --ei; length 61.5 m, hub radius 1.5 m if not given\n"
    "  --mass-factor F  of the blade's mass per length (1)\n"
    "  --picture FILE   Campbell diagram as SVG, its data beside it as CSV (wants gnuplot)\n"
    "  --help           this text\n"
    "flap is out of the plane of rotation, lag (edge) in it: the larger displacement of the tip. Good to 1e-4 up to\n"
    "spin sqrt(m L^3/EI) = 30, 5e-4 with a tip mass.\n";

static int read_spins(options *o, const char *text, const char *name, double unit)
{
  o->spins = read_list(o->spin, MAX_SPINS, text);
  for (int k = 0; k < o->spins; k++) {
    if (fabs(o->spin[k]) > 1e6) {
      return fail("a spin is at most 1e6", text);
    }
    o->spin[k] *= unit;
  }
  return o->spins > 0 ? 0 : fail("no list of numbers, at most 256, with commas between", name);
}

static int read_option(void *to, const char *name, const char *text)
{
  options *const o = (options *)to;
  double modes = o->modes;
  const number_option list[] = {{"--length", &o->length, 1e-9, 1e12},  {"--mass", &o->mass, 1e-12, 1e12},
                                {"--ei", &o->ei, 1e-12, 1e18},         {"--hub-radius", &o->hub_radius, 0, 1e12},
                                {"--tip-mass", &o->tip_mass, 0, 1e12}, {"--mass-factor", &o->mass_factor, 1e-9, 1e9},
                                {"--modes", &modes, 1, MAX_MODES}};
  int status = 0;
  if (strcmp(name, "--blade") == 0) {
    o->blade = text;
  } else if (strcmp(name, "--picture") == 0) {
    o->picture = text;
  } else if (strcmp(name, "--spin") == 0 || strcmp(name, "--rpm") == 0) {
    status = read_spins(o, text, name, name[2] == 's' ? 1.0 : 2.0 * pi / 60.0);
  } else {
    status = read_number(list, (int)(sizeof list / sizeof list[0]), name, text);
    if (status == 0 && modes != floor(modes)) {
      return fail("--modes wants a whole number", text);
    }
    o->modes = (int)modes;
  }
  return status;
}

/* What was not given: a uniform boom, or the blade of the table. */
static void fill_in(options *o)
{
  o->length = o->length > 0 ? o->length : o->blade ? 61.5 : 10;
  o->hub_radius = o->hub_radius >= 0 ? o->hub_radius : o->blade ? 1.5 : 0;
  for (int k = 0; o->spins == 0 && k < (o->blade ? 11 : 4); k++) {
    o->spin[k] = o->blade ? 2.0 * k * 2.0 * pi / 60.0 : 2.0 * k;
  }
  o->spins = o->spins > 0 ? o->spins : o->blade ? 11 : 4;
}

static fb_beam_desc beam_desc;
static fb_beam beam;
static fb_modes modes;
static fb_modes_work modes_work;
static fb_shape shape;
static fb_body body;
static fb_body_work body_work;
static fb_analyse_work analyse_work;
static fb_spectrum spectrum;

/* Stations of a blade table: along x, flap along z, edge along y. */
static int read_blade(const options *o)
{
  static const char *const column[7] = {"span_fraction", "twist_deg", "mass", "EI_flap", "EI_edge", "GJ", "EA"};
  text_file t;
  double last = 0;
  int n = 0;
  if (!text_open(&t, "campbell", o->blade)) {
    return 0;
  }
  t.table = 1;
  if (!text_line(&t)) {
    text_fail(&t, "holds nothing but comments");
  }
  for (int k = 0; k < 7 && !t.failed; k++) {
    const char *word = text_word(&t);
    if (!word || strcmp(word, column[k]) != 0) {
      text_fail(&t, "column %d must be %s, is %s", k + 1, column[k], word ? word : "missing");
    }
  }
  text_end_of_line(&t);
  while (text_line(&t)) {
    double x[7];
    fb_section *s = &beam_desc.station[n];
    for (int k = 0; k < 7; k++) {
      x[k] = text_number(&t, column[k]);
    }
    text_end_of_line(&t);
    if (n == FB_MAX_STATIONS) {
      text_fail(&t, "more than %d stations", FB_MAX_STATIONS);
    }
    if (!t.failed && (n == 0 ? fabs(x[0]) > 0 : x[0] <= last)) {
      text_fail(&t, n == 0 ? "the first span_fraction must be 0" : "span_fraction must ascend");
    }
    for (int k = 2; k < 7 && !t.failed; k++) {
      if (x[k] <= 0) {
        text_fail(&t, "%s must be greater than 0", column[k]);
      }
    }
    if (t.failed) {
      break;
    }
    last = x[0];
    s->x = (fb_real)(x[0] * o->length);
    s->twist = (fb_real)(x[1] * pi / 180.0);
    s->mass = (fb_real)(x[2] * o->mass_factor);
    s->EI_y = (fb_real)x[3];
    s->EI_z = (fb_real)x[4];
    s->GJ = (fb_real)x[5];
    s->EA = (fb_real)x[6];
    n++;
  }
  if (!t.failed && (n < 2 || fabs(last - 1.0) > 1e-9)) {
    text_fail(&t, "the last span_fraction must be 1");
  }
  text_close(&t);
  beam_desc.n_station = n;
  return !t.failed;
}

static int describe(const options *o)
{
  beam_desc.length = (fb_real)o->length;
  beam_desc.n_element = o->blade ? 12 : 20;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = (fb_real)(o->mass / o->length);
  beam_desc.station[0].EI_y = beam_desc.station[0].EI_z = (fb_real)o->ei;
  beam_desc.n_lump = 1;
  beam_desc.lump[0].node = beam_desc.n_element;
  beam_desc.lump[0].mass = (fb_real)o->tip_mass;
  beam_desc.position[0] = (fb_real)o->hub_radius;
  return !o->blade || read_blade(o);
}

/* A body with the bending modes of one plane, or of both where the sections are turned. */
static fb_status build(const options *o, int lag, int flap)
{
  fb_modes_desc keep;
  fb_body_desc level;
  fb_status status;
  int node;
  memset(&keep, 0, sizeof keep);
  memset(&level, 0, sizeof level);
  keep.count[FB_KIND_BEND_Y] = lag ? o->modes > 4 ? 12 : 8 : 0; /* more than printed */
  keep.count[FB_KIND_BEND_Z] = flap ? o->modes > 4 ? 12 : 8 : 0;
  for (int s = 0; s < o->spins; s++) { /* shaped for the fastest spin, good for all below */
    keep.spin = (fb_real)fmax((double)keep.spin, fabs(o->spin[s]));
  }
  keep.spin_radius = (fb_real)o->hub_radius;
  level.effects = FB_EFFECTS_FULL;
  level.base = FB_BASE_PRESCRIBED;
  status = fb_beam_init(&beam, &beam_desc);
  status = status ? status : fb_modes_solve(&modes, &modes_work, &beam, &keep);
  status = status ? status : fb_shape_init(&shape, modes.n);
  status = status ? status : fb_shape_add_beam(&shape, 0, &beam, &modes);
  status = status ? status : fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, beam.desc.length);
  return status ? status : fb_body_init(&body, &body_work, &shape, &level);
}

/* Does complex mode k move the tip out of the plane more than in it? */
static int is_flap(int k)
{
  double square[3] = {0, 0, 0};
  for (int part = 0; part < 2; part++) {
    const fb_real *q = (part ? spectrum.shape_im : spectrum.shape_re) + k * body.n;
    for (int i = 1; i < 3; i++) {
      double u = 0;
      for (int a = 0; a < body.n; a++) {
        u += (double)shape.node[1].psi[3 * a + i] * (double)q[a];
      }
      square[i] += u * u;
    }
  }
  return square[2] > square[1];
}

/* Frequencies [spin][flap][mode] of the body built, of the kinds it was built for. */
static double table[MAX_SPINS][2][MAX_MODES];
static fb_status solve(const options *o)
{
  fb_status status = FB_OK;
  for (int s = 0; s < o->spins && status == FB_OK; s++) {
    int count[2] = {0, 0};
    fb_state state;
    fb_input input;
    memset(&input, 0, sizeof input);
    input.w[2] = (fb_real)o->spin[s];
    status = fb_state_init(&body, &state);
    status = status ? status : fb_body_trim(&body, &state, &analyse_work, &input);
    status = status ? status : fb_body_spectrum_solve(&body, &analyse_work, &spectrum, &state, &input);
    for (int k = 0; k < spectrum.n && status == FB_OK; k++) {
      const int flap = is_flap(k);
      if (count[flap] < o->modes) { /* an unstable one is printed as a negative frequency */
        table[s][flap][count[flap]++] =
            spectrum.im[k] > FB_R(0.0) ? (double)spectrum.im[k] : -fabs((double)spectrum.re[k]);
      }
    }
  }
  return status;
}

/* Campbell diagram: frequencies and multiples of the speed over the speed, Hz and rpm. */
static int draw(const options *o)
{
  static const char *const kind[2] = {"lag", "flap"};
  static char name[1024], column[3 * MAX_MODES][32], title[3 * MAX_MODES][32], style[3 * MAX_MODES][64];
  curve curves[3 * MAX_MODES];
  int n = 0;
  FILE *out;
  if (snprintf(name, sizeof name, "%s.csv", o->picture) >= (int)sizeof name || !(out = output_open(name))) {
    fprintf(stderr, "campbell: cannot write %s.csv\n", o->picture);
    return 0;
  }
  fprintf(out, "# spin [rpm], then [Hz] lag 1.., flap 1..\n");
  for (int s = 0; s < o->spins; s++) {
    fprintf(out, "%.10g", o->spin[s] * 60.0 / (2.0 * pi));
    for (int i = 0; i < 2 * o->modes; i++) {
      fprintf(out, ",%.12g", table[s][i / o->modes][i % o->modes] / (2.0 * pi));
    }
    fputs("\n", out);
  }
  if (output_close(out, name)) {
    return 0;
  }
  for (int i = 0; i < 2 * o->modes + 4; i++) {
    const int harmonic = i - 2 * o->modes + 1;
    curves[n].file = name;
    if (harmonic > 0) {
      snprintf(column[n], sizeof column[n], "1:($1*%d/60)", harmonic);
      snprintf(title[n], sizeof title[n], "%d per turn", harmonic);
      snprintf(style[n], sizeof style[n], "with lines dashtype %d linecolor rgb '#777777'", harmonic + 1);
    } else {
      snprintf(column[n], sizeof column[n], "1:%d", i + 2);
      snprintf(title[n], sizeof title[n], "%s %d", kind[i / o->modes], i % o->modes + 1);
      snprintf(style[n], sizeof style[n], "with lines linewidth 2");
    }
    curves[n].columns = column[n];
    curves[n].title = title[n];
    curves[n].style = style[n];
    n++;
  }
  plot(o->picture, "set xlabel 'spin [rpm]'\nset ylabel 'frequency [Hz]'\nset yrange [0:*]\n", curves, n, stderr);
  return 1;
}

int campbell_main(int argc, char **argv)
{
  static options o = {0, BOOM_MASS, BOOM_EI, -1, 0, 1, {0}, 0, 4, NULL, NULL};
  static const char *const names[] = {"lag", "flap"};
  int bad;
  fb_status status;
  output_begin(PROGRAM);
  bad = read_all(argc, argv, help, read_option, &o);
  if (bad) {
    return bad;
  }
  fill_in(&o);
  if (!describe(&o)) {
    return 2;
  }
  if (o.blade) {
    status = build(&o, 1, 1);
    status = status ? status : solve(&o);
  } else { /* planes that do not know of each other, with equal frequencies at rest */
    status = build(&o, 1, 0);
    status = status ? status : solve(&o);
    status = status ? status : build(&o, 0, 1);
    status = status ? status : solve(&o);
  }
  if (status != FB_OK) {
    fprintf(stderr, "campbell: %s\n", refusal_text(status));
    return 1;
  }
  printf("spin,kind,mode,omega\n");
  for (int s = 0; s < o.spins; s++) {
    for (int flap = 1; flap >= 0; flap--) {
      for (int k = 0; k < o.modes; k++) {
        printf("%.10g,%s,%d,%.12g\n", o.spin[s], names[flap], k + 1, table[s][flap][k]);
      }
    }
  }
  return !o.picture || draw(&o) ? 0 : 1;
}
