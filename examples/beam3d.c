/* beam3d - reads a beam from a small text file and says how it stands under its loads, and how it vibrates about that.
   README.md, "Beams from files", lists the words; examples/bend45.txt is one.
   Exit: 0 well, 1 no such state, 2 bad options or file. */
#define _POSIX_C_SOURCE 200809L /* popen, for gnuplot */
#define FB_MAX_MIXED 400
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#define PROGRAM "beam3d"
#include "options.h"
#include "mixed_beam.h"
#include "plot.h"
#include "text.h"

static const char help[] =
    "beam3d - a geometrically exact beam from a text file: deflection, root loads, frequencies; any consistent units\n"
    "usage: beam3d FILE [--out SHAPE.csv]\n"
    "  the file, one word and its numbers a line, # begins a comment:\n"
    "    length L                      of the line\n"
    "    elements N                    equal ones, 1 to 400 (20)\n"
    "    station X                     the lines that follow, up to the next station, are of the section at X\n"
    "      stiffness ...               6 (axial, shear y, shear z, twist, bending about y, about z), 21 (upper "
    "triangle\n"
    "                                  by rows) or 36 numbers; 0 on the diagonal: rigid\n"
    "      inertia ...                 the same of (momentum; angular momentum) per length by (velocity; rate)\n"
    "      mass M [Y Z]                per length, its center off the line: instead of inertia\n"
    "      twist DEGREES               of the section axes about the line\n"
    "      curvature KX KY KZ          of the unloaded line, section axes\n"
    "    position X Y Z                of the root (0 0 0)\n"
    "    attitude RX RY RZ             rotation vector of the root in degrees (0 0 0)\n"
    "    root END, tip END             clamped, pinned, guided, sliding, free, or any of x y z rx ry rz (root "
    "clamped,\n"
    "                                  tip free)\n"
    "    support X END                 at the node nearest to X\n"
    "    lump X MASS [CX CY CZ [IXX IYY IZZ]]   rigid body on the node nearest to X\n"
    "    gravity GX GY GZ\n"
    "    velocity VX VY VZ, spin WX WY WZ       steady motion of the base\n"
    "    load X AXES FX FY FZ [MX MY MZ]        at the node nearest to X; AXES: dead, follower or base\n"
    "    line A B AXES FX FY FZ [MX MY MZ]      per length, from the node nearest to A to that nearest to B\n"
    "    modes N                       slowest motions to print, 0 to 24 (6)\n"
    "  --out FILE  x, y, z of 201 points along the deformed line; three views beside it as .svg\n"
    "  --help      this text\n";

/* ---- reading */

typedef struct deck { /* what needs the whole file before it can be used */
  int modes, station_open;
  int n_load, n_line, n_support, n_lump;
  double load_at[FB_MAX_LOADS], support_at[FB_MAX_LUMPS], lump_at[FB_MAX_LUMPS];
  struct {
    double a, b;
    fb_line_load load;
  } line[64];
} deck;

static void read_reals(text_file *t, const char *what, fb_real *x, int n)
{
  double value[6] = {0};
  text_vector(t, what, value, n);
  for (int i = 0; i < n; i++) {
    x[i] = (fb_real)value[i];
  }
}

/* 6, 21 or 36 numbers to a full 6x6. */
static void read_matrix(text_file *t, const char *what, fb_real A[36])
{
  double x[36];
  int n = 0;
  while (text_more(t) && n < 36) {
    x[n++] = text_number(t, what);
  }
  if (n != 6 && n != 21 && n != 36) {
    text_fail(t, "%s wants 6, 21 or 36 numbers, not %d", what, n);
    return;
  }
  for (int i = 0, at = 0; i < 6; i++) {
    for (int j = 0; j < 6; j++) {
      if (n == 36) {
        A[6 * i + j] = (fb_real)x[6 * i + j];
      } else if (n == 6) {
        A[6 * i + j] = i == j ? (fb_real)x[i] : 0;
      } else if (j >= i) {
        A[6 * i + j] = A[6 * j + i] = (fb_real)x[at++];
      }
    }
  }
}

static int read_end(text_file *t)
{
  static const struct {
    const char *name;
    int held;
  } ends[] = {
      {"clamped", FB_END_CLAMPED}, {"pinned", FB_END_PINNED}, {"guided", FB_END_GUIDED}, {"sliding", FB_END_SLIDING},
      {"free", FB_END_FREE},       {"x", FB_HOLD_X},          {"y", FB_HOLD_Y},          {"z", FB_HOLD_Z},
      {"rx", FB_HOLD_RX},          {"ry", FB_HOLD_RY},        {"rz", FB_HOLD_RZ}};
  int held = 0;
  do {
    const char *word = text_word(t);
    size_t k = 0;
    while (word && k < sizeof ends / sizeof ends[0] && strcmp(word, ends[k].name) != 0) {
      k++;
    }
    if (!word || k == sizeof ends / sizeof ends[0]) {
      text_fail(t, "an end is clamped, pinned, guided, sliding, free, or some of x y z rx ry rz");
      return 0;
    }
    held |= ends[k].held;
  } while (text_more(t));
  return held;
}

static fb_axes read_axes(text_file *t)
{
  const char *word = text_word(t);
  if (word && strcmp(word, "dead") == 0) {
    return FB_AXES_INERTIAL;
  }
  if (word && strcmp(word, "follower") == 0) {
    return FB_AXES_NODE;
  }
  if (!word || strcmp(word, "base") != 0) {
    text_fail(t, "axes of a load are dead, follower or base");
  }
  return FB_AXES_BODY;
}

static void read_force(text_file *t, fb_real force[3], fb_real torque[3])
{
  read_reals(t, "force x y z", force, 3);
  if (text_more(t)) {
    read_reals(t, "moment x y z", torque, 3);
  }
}

/* Words of a station; 0 if it is none of them. */
static int read_section(text_file *t, const deck *d, const char *word)
{
  static const char *const words[] = {"stiffness", "inertia", "mass", "twist", "curvature"};
  fb_mixed_station *const s = &beam_desc.station[beam_desc.n_station > 0 ? beam_desc.n_station - 1 : 0];
  int k = 0;
  while (k < 5 && strcmp(word, words[k]) != 0) {
    k++;
  }
  if (k < 5 && !d->station_open) {
    text_fail(t, "%s belongs to a station: begin it with \"station X\"", word);
  } else if (k == 0) {
    read_matrix(t, word, s->stiffness);
  } else if (k == 1) {
    read_matrix(t, word, s->inertia);
  } else if (k == 2) {
    fb_section section;
    fb_mixed_station made;
    memset(&section, 0, sizeof section);
    section.mass = (fb_real)text_number(t, word);
    if (text_more(t)) {
      section.mass_y = (fb_real)text_number(t, "y of the mass center");
      section.mass_z = (fb_real)text_number(t, "z of the mass center");
    }
    if (fb_mixed_station_init(&made, &section) != FB_OK) {
      text_fail(t, "mass is zero or more");
    }
    memcpy(s->inertia, made.inertia, sizeof s->inertia);
  } else if (k == 3) {
    s->twist = (fb_real)(text_number(t, word) * pi / 180);
  } else if (k == 4) {
    read_reals(t, word, s->curvature, 3);
  }
  return k < 5;
}

static void read_station(text_file *t, deck *d)
{
  if (beam_desc.n_station == FB_MAX_STATIONS) {
    text_fail(t, "more than %d stations", FB_MAX_STATIONS);
    return;
  }
  if (beam_desc.n_station > 0) { /* what is not given is that of the station before */
    beam_desc.station[beam_desc.n_station] = beam_desc.station[beam_desc.n_station - 1];
  }
  beam_desc.station[beam_desc.n_station++].x = (fb_real)text_number(t, "x of the station");
  d->station_open = 1;
}

static void read_lump(text_file *t, deck *d)
{
  fb_lump *const lump = &beam_desc.lump[d->n_lump];
  if (d->n_lump == FB_MAX_LUMPS) {
    text_fail(t, "more than %d lumps", FB_MAX_LUMPS);
    return;
  }
  d->lump_at[d->n_lump++] = text_number(t, "x of the lump");
  lump->mass = (fb_real)text_number(t, "mass");
  if (text_more(t)) {
    read_reals(t, "center x y z", lump->center, 3);
  }
  if (text_more(t)) {
    read_reals(t, "inertia xx yy zz", lump->inertia, 3);
  }
}

/* Loads, supports and lumps, which name places; 0 if it is none of them. */
static int read_place(text_file *t, deck *d, const char *word)
{
  if (strcmp(word, "load") == 0) {
    fb_load *const load = &beam_input.load[d->n_load];
    if (d->n_load == FB_MAX_LOADS) {
      text_fail(t, "more than %d loads", FB_MAX_LOADS);
      return 1;
    }
    d->load_at[d->n_load++] = text_number(t, "x of the load");
    load->axes = read_axes(t);
    read_force(t, load->force, load->torque);
  } else if (strcmp(word, "line") == 0) {
    if (d->n_line == 64) {
      text_fail(t, "more than 64 line loads");
      return 1;
    }
    d->line[d->n_line].a = text_number(t, "begin of the line load");
    d->line[d->n_line].b = text_number(t, "end of the line load");
    d->line[d->n_line].load.axes = read_axes(t);
    read_force(t, d->line[d->n_line].load.force, d->line[d->n_line].load.torque);
    d->n_line++;
  } else if (strcmp(word, "support") == 0) {
    if (d->n_support == FB_MAX_LUMPS) {
      text_fail(t, "more than %d supports", FB_MAX_LUMPS);
      return 1;
    }
    d->support_at[d->n_support] = text_number(t, "x of the support");
    beam_desc.support[d->n_support++].held = read_end(t);
  } else if (strcmp(word, "lump") == 0) {
    read_lump(t, d);
  } else {
    return 0;
  }
  return 1;
}

static void read_line(text_file *t, deck *d, const char *word)
{
  if (strcmp(word, "length") == 0) {
    beam_desc.length = (fb_real)text_number(t, word);
  } else if (strcmp(word, "elements") == 0) {
    beam_desc.n_element = text_whole(t, word, 1, FB_MAX_MIXED);
  } else if (strcmp(word, "station") == 0) {
    read_station(t, d);
  } else if (strcmp(word, "position") == 0) {
    read_reals(t, word, beam_desc.position, 3);
  } else if (strcmp(word, "attitude") == 0) {
    fb_real turn[3] = {0, 0, 0};
    read_reals(t, word, turn, 3);
    for (int i = 0; i < 3; i++) {
      turn[i] *= (fb_real)(pi / 180);
    }
    fb_quat_from_rotvec(beam_desc.attitude, turn);
  } else if (strcmp(word, "root") == 0) {
    beam_desc.root = read_end(t);
  } else if (strcmp(word, "tip") == 0) {
    beam_desc.tip = read_end(t);
  } else if (strcmp(word, "gravity") == 0) {
    read_reals(t, word, beam_desc.gravity, 3);
  } else if (strcmp(word, "velocity") == 0) {
    read_reals(t, word, beam_input.v, 3);
  } else if (strcmp(word, "spin") == 0) {
    read_reals(t, word, beam_input.w, 3);
  } else if (strcmp(word, "modes") == 0) {
    d->modes = text_whole(t, word, 0, FB_MIXED_MODES);
  } else if (!read_section(t, d, word) && !read_place(t, d, word)) {
    text_fail(t, "unknown word: %s (see --help)", word);
  }
  text_end_of_line(t);
}

static int nearest(text_file *t, double x, const char *what)
{
  const double L = (double)beam_desc.length;
  if (!(x >= -1e-9 * L && x <= L * (1 + 1e-9))) {
    text_fail(t, "%s at %g is not on the beam", what, x);
    return 0;
  }
  return (int)lround(x / L * beam_desc.n_element);
}

/* Places to nodes, now that length and elements are known. */
static void place(text_file *t, const deck *d)
{
  const int n = beam_desc.n_element;
  t->line = 0;
  if (!(beam_desc.length > 0)) {
    text_fail(t, "length is missing, or not positive");
    return;
  }
  if (beam_desc.n_station == 0) {
    text_fail(t, "no station");
    return;
  }
  beam_input.n_load = d->n_load;
  beam_desc.n_support = d->n_support;
  beam_desc.n_lump = d->n_lump;
  for (int k = 0; k < d->n_load; k++) {
    beam_input.load[k].node = nearest(t, d->load_at[k], "a load");
  }
  for (int k = 0; k < d->n_support; k++) {
    beam_desc.support[k].node = nearest(t, d->support_at[k], "a support");
  }
  for (int k = 0; k < d->n_lump; k++) {
    beam_desc.lump[k].node = nearest(t, d->lump_at[k], "a lump");
  }
  for (int l = 0; l < d->n_line; l++) {
    const int a = nearest(t, d->line[l].a, "a line load"), b = nearest(t, d->line[l].b, "a line load");
    if (a >= b) {
      text_fail(t, "a line load from %g to %g covers no element", d->line[l].a, d->line[l].b);
    }
    for (int k = a; k < b && k < n; k++) {
      fb_line_load *const line = &beam_input.line[k];
      const fb_real *const f = line->force, *const m = line->torque;
      const int taken = f[0] * f[0] + f[1] * f[1] + f[2] * f[2] + m[0] * m[0] + m[1] * m[1] + m[2] * m[2] > 0;
      if (taken && line->axes != d->line[l].load.axes) {
        text_fail(t, "line loads of different axes overlap");
      }
      line->axes = d->line[l].load.axes;
      for (int i = 0; i < 3; i++) {
        line->force[i] += d->line[l].load.force[i];
        line->torque[i] += d->line[l].load.torque[i];
      }
    }
  }
}

static int read_file(const char *name, deck *d)
{
  text_file t;
  memset(&beam_desc, 0, sizeof beam_desc);
  memset(&beam_input, 0, sizeof beam_input);
  memset(d, 0, sizeof *d);
  beam_desc.n_element = 20;
  d->modes = 6;
  if (!text_open(&t, PROGRAM, name)) {
    return 2;
  }
  while (text_line(&t)) {
    const char *word = text_word(&t);
    if (word) {
      read_line(&t, d, word);
    }
  }
  if (!t.failed) {
    place(&t, d);
  }
  text_close(&t);
  return t.failed ? 2 : 0;
}

/* ---- telling */

static void row(const char *what, const fb_real x[3], double unit)
{
  printf("%-28s %14.7g %14.7g %14.7g\n", what, (double)x[0] * unit, (double)x[1] * unit, (double)x[2] * unit);
}

static void tell_state(void)
{
  const fb_mixed_node *const tip = &beam_node[beam_desc.n_element], *const root = &beam_node[0];
  fb_energy energy;
  printf("%d elements, %d iterations, %d load increments\n", beam_desc.n_element, beam_work.iterations,
         beam_work.increments);
  printf("%-28s %14s %14s %14s\n", "", "x", "y", "z");
  row("tip position", tip->position, 1);
  row("tip displacement", tip->displacement, 1);
  row("tip rotation [degrees]", tip->rotation, 180 / pi);
  row("  Wiener-Milenkovic", tip->wiener_milenkovic, 1);
  row("force on the root, section", root->force, 1);
  row("moment on the root, section", root->moment, 1);
  for (int k = 1; k <= beam_desc.n_element; k++) {
    if (beam.held[k]) {
      printf("support at node %d, on the beam, its section axes\n", k);
      row("  force", beam_node[k].reaction_force, 1);
      row("  moment", beam_node[k].reaction_moment, 1);
      row("  inner moment, inboard", beam_node[k].moment, 1);
    }
  }
  (void)fb_mixed_energy(&beam, &energy, &beam_state);
  printf("%-28s %14.7g\n", "strain energy", (double)energy.strain);
}

static fb_status tell_modes(int count)
{
  static fb_mixed_spectrum spectrum;
  static fb_mixed_spectrum_work work;
  const fb_status status = fb_mixed_spectrum_solve(&beam, &spectrum, &work, &beam_state, &beam_input, count);
  if (status != FB_OK) {
    return status;
  }
  printf("mode   frequency [1/s]   rate [rad/s]   growth [1/s]\n");
  for (int k = 0; k < spectrum.n; k++) {
    const double re = (double)spectrum.re[k], im = (double)spectrum.im[k];
    const int still = fabs(re) < 1e-6 * fabs(im); /* what is left of rounding */
    printf("%4d  %16.7g  %13.7g  %13.4g%s\n", k + 1, im / (2 * pi), im, still ? 0 : re,
           !still && re > 0 ? "  unstable" : "");
  }
  return FB_OK;
}

static int draw(const char *out)
{
  char svg[512];
  FILE *const csv = beam_open(out);
  const curve views[] = {{out, "1:2", "with lines", "y over x"},
                         {out, "1:3", "with lines", "z over x"},
                         {out, "2:3", "with lines", "z over y"}};
  if (!csv) {
    return 2;
  }
  fputs("x,y,z\n", csv);
  beam_write_shape(csv, 200);
  fclose(csv);
  beam_file_name(svg, sizeof svg, out, ".svg");
  plot(svg, "set size ratio -1\nset xlabel ''\nset key top right\n", views, 3, stdout);
  return 0;
}

static int read_option(void *target, const char *name, const char *text)
{
  return strcmp(name, "--out") == 0 ? read_out((const char **)target, text) : NO_SUCH_OPTION;
}

int main(int argc, char **argv)
{
  static deck d;
  const char *out = NULL;
  fb_status status;
  if (argc < 2 || strcmp(argv[1], "--help") == 0) {
    fputs(help, argc < 2 ? stderr : stdout);
    return argc < 2 ? 2 : 0;
  }
  if (read_all(argc - 1, argv + 1, help, read_option, &out) != 0 || read_file(argv[1], &d) != 0) {
    return 2;
  }
  status = beam_start();
  if (status != FB_OK) {
    fprintf(stderr, "beam3d: %s: %s\n", argv[1], fb_status_string(status));
    return 2;
  }
  status = beam_settle();
  if (status == FB_OK) {
    tell_state();
    status = d.modes > 0 ? tell_modes(d.modes) : FB_OK;
    if (status != FB_OK) {
      fprintf(stderr, "beam3d: modes: %s\n", fb_status_string(status));
      return 1;
    }
  } else {
    fprintf(stderr, "beam3d: no steady state found: %s (%d load increments tried)%s\n", fb_status_string(status),
            beam_work.increments,
            status == FB_ERR_SINGULAR
                ? "; is it held against every motion, and the root, not the tip, where it is rigid?"
                : "");
    return 1;
  }
  return out ? draw(out) : 0;
}
