/* exact - reads a beam from a small text file and says how it stands under its loads, and how it vibrates about that.
   examples/tools/README.md lists the words; examples/bend45.txt is one.
   Exit: 0 well, 1 no such state, 2 bad options or file. */
#define _POSIX_C_SOURCE 200809L /* popen, for gnuplot */
#include "capacities.h"
#include "../../flexbeam.h"
#include "../common/refusal.h"
#define PROGRAM "exact"
#include "../common/options.h"
#include "words.h"
#include "../common/output.h"
#include "../common/exact_beam.h"
#include "../common/plot.h"
#include "../common/linear_out.h"
#include "../common/same_file.h"
#include "exact_text.h"
#include "ports.h"

static const char help[] =
    "exact - a geometrically exact beam from a text file: deflection, root loads, frequencies; any consistent units\n"
    "usage: flexbeam exact FILE [options]\n"
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
    "    point X Y Z                   of the line, 2 to 200 of them: in place of position, attitude and curvature;\n"
    "                                  without length places are along the line through them\n"
    "    position X Y Z                of the root (0 0 0)\n"
    "    attitude RX RY RZ             rotation vector of the root in degrees (0 0 0)\n"
    "    root END, tip END             clamped, pinned, guided, sliding, free, or any of x y z rx ry rz (root "
    "clamped,\n"
    "                                  tip free)\n"
    "    support X END                 at the node nearest to X\n"
    "    move X DX DY DZ [RX RY RZ]    what holds it at X (or tip), from where it is built: base axes, rotation vector "
    "in\n"
    "                                  degrees, section axes; slack lines are built straight, their end is moved in\n"
    "    lump X MASS [CX CY CZ [IXX IYY IZZ]]   rigid body on the node nearest to X\n"
    "    joint X AX AY AZ [angle DEGREES] [rate W] [rest DEGREES] [stiffness K] [damping C] [motor T] [driven W]\n"
    "                                  hinge at the node nearest to X about that axis of the section there\n"
    "    gravity GX GY GZ, dissipation D, box   (box: inertia along and about the line stays in the middle)\n"
    "    damping MU                    structural, in seconds: stress = stiffness (strain + MU strain rate);\n"
    "                                  or six: of stretch, shear y z, torsion, bending y z\n"
    "    damping_ratio Z HZ            the same by the damping ratio Z that a motion of HZ has\n"
    "    velocity VX VY VZ, spin WX WY WZ       steady motion of the base\n"
    "    load X AXES FX FY FZ [MX MY MZ]        at the node nearest to X; AXES: dead, follower or base\n"
    "    line A B AXES FX FY FZ [MX MY MZ]      per length, from the node nearest to A to that nearest to B\n"
    "    branch X [N]                  the lines that follow are of a branch that begins at X of the line, or of "
    "branch N:\n"
    "                                  length, elements, attitude (of its root to the sections there), station, "
    "support,\n"
    "                                  lump, joint, load, line, by places of its own; what is left out is as of the "
    "line\n"
    "    modes N                       slowest motions to print, 0 to 24 (6)\n"
    "  --out FILE  x, y, z of 201 points along the deformed line; three views beside it as .svg\n"
    "  --linear FILE   A, B, C, D of those slowest motions about the steady state, with names and units: FILE.json, or "
    "CSV\n"
    "  --inputs LIST   of it, with commas between: force.NODE.AXIS, torque.NODE.AXIS, base_velocity.AXIS, "
    "base_rate.AXIS;\n"
    "                  base axes; NODE a number, root or tip, AXIS x, y or z (force and torque at the tip);\n"
    "                  support_displacement.NODE.AXIS, support_rotation.NODE.AXIS (section axes): of nodes that are\n"
    "                  held, but the root;\n"
    "                  drive.JOINT, a number from 0\n"
    "  --outputs LIST  displacement (base axes), rotation, velocity, rate, each .NODE.AXIS; internal_force, "
    "internal_moment,\n"
    "                  force_strain, moment_strain, each .ELEMENT.AXIS, a number from 0, root or tip;\n"
    "                  coordinate.JOINT, speed.JOINT\n"
    "                  (displacement of the tip, moment at the root)\n"
    "  --help      this text\n";

typedef struct options {
  const char *out, *linear, *inputs, *outputs;
} options;

/* The description, to the beam of exact_beam.h; 0, or 2 after a message. */
static int read_file(const char *name, int *modes)
{
  static exact_text m;
  text_file t;
  exact_begin(&m);
  if (!text_open(&t, PROGRAM, name)) {
    return 2;
  }
  while (text_line(&t)) {
    exact_line(&t, &m, text_word(&t));
  }
  t.line = 0; /* what is missing has no line */
  if (!t.failed) {
    exact_places(&t, &m);
  }
  if (!t.failed && m.doubt[0]) {
    fprintf(stderr, "%s: %s: warning: %s\n", PROGRAM, name, m.doubt);
  }
  text_close(&t);
  beam_desc = m.desc;
  beam_input = m.input;
  *modes = m.modes;
  return t.failed ? 2 : 0;
}

/* ---- telling */

static void row(const char *what, const fb_real x[3], double unit)
{
  printf("%-28s %14.7g %14.7g %14.7g\n", what, (double)x[0] * unit, (double)x[1] * unit, (double)x[2] * unit);
}

static void tell_state(void)
{
  const fb_exact_node *const tip = &beam_node[beam_desc.n_element], *const root = &beam_node[0];
  fb_energy energy = {0};
  printf("%d elements, %d iterations, %d load increments\n", beam.n, beam_work.iterations, beam_work.increments);
  printf("%-28s %14s %14s %14s\n", "", "x", "y", "z");
  row("tip position", tip->position, 1);
  row("tip displacement", tip->displacement, 1);
  row("tip rotation [degrees]", tip->rotation, 180 / pi);
  row("  Wiener-Milenkovic", tip->wiener_milenkovic, 1);
  row("force on the root, section", root->force, 1);
  row("moment on the root, section", root->moment, 1);
  for (int b = 0, at = beam_desc.n_element; b < beam_desc.n_branch; b++) {
    char what[40];
    at += beam_desc.branch[b].n_element;
    snprintf(what, sizeof what, "branch %d, tip position", b + 1);
    row(what, beam_node[at].position, 1);
    row("  displacement", beam_node[at].displacement, 1);
    row("  rotation [degrees]", beam_node[at].rotation, 180 / pi);
  }
  for (int k = 1; k <= beam.n; k++) {
    if (beam.held[k]) {
      printf("support at node %d, on the beam, its section axes\n", k);
      row("  force", beam_node[k].reaction_force, 1);
      row("  moment", beam_node[k].reaction_moment, 1);
      row("  inner moment, inboard", beam_node[k].moment, 1);
    }
  }
  for (int k = 0; k < beam_desc.n_joint; k++) {
    fb_exact_hinge joint = {0};
    (void)fb_exact_joint_eval(&beam, &joint, &beam_state, k);
    printf("joint %d%*s %14.7g degrees, moment %.7g\n", k, k < 10 ? 20 : 19, "", (double)joint.angle * 180 / pi,
           (double)joint.moment);
  }
  (void)fb_exact_energy_eval(&beam, &energy, &beam_state);
  printf("%-28s %14.7g\n", "strain energy", (double)energy.strain);
  // of a base that spins gyroscopic forces decide
  if (beam_work.unstable > 0 && fb_vec3_dot(beam_input.w, beam_input.w) == 0) {
    char why[160];
    printf("%-28s %14d directions, %s\n", "unstable in", beam_work.unstable,
           exact_overstretched(why, &beam, &beam_state) ? why : "as beyond a buckling load");
  }
}

static fb_status tell_modes(int count)
{
  static fb_exact_spectrum spectrum;
  static fb_exact_spectrum_work work;
  const fb_status status = fb_exact_spectrum_solve(&beam, &work, &spectrum, &beam_state, &beam_input, count);
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

/* One port, as force.tip.y; base_rate.z. 0, or 2 after a message. */
static int read_port(void *ports, int k, const char *option, const char *word)
{
  fb_port *const port = (fb_port *)ports + k;
  const int kind = port_kind(linear_ports, FB_PORT_COUNT, word);
  const int support = kind == FB_PORT_SUPPORT_DISPLACEMENT || kind == FB_PORT_SUPPORT_ROTATION;
  const int of_element = kind >= FB_PORT_INTERNAL_FORCE && !support, count = beam.n + !of_element;
  const int of_joint = kind >= FB_PORT_DRIVE && kind <= FB_PORT_SPEED;
  const int is_input = kind < FB_PORT_DISPLACEMENT || kind == FB_PORT_DRIVE || support;
  port_place place;
  if (kind == FB_PORT_COUNT || kind == FB_PORT_ACCELERATION || (kind > FB_PORT_SPEED && kind < FB_PORT_VELOCITY) ||
      is_input != (option[2] == 'i')) {
    return fail_port(option, word, "no such kind (see --help)");
  }
  memset(port, 0, sizeof *port);
  port->kind = (fb_port_kind)kind;
  if (of_joint) {
    port->body = port_number(word + strcspn(word, ".") + (strchr(word, '.') != NULL), beam_desc.n_joint);
    return port->body >= 0 ? 0 : fail_port(option, word, "no such joint: numbers from 0, in the order of their lines");
  }
  if (read_place(&place, option, word)) {
    return 2;
  }
  port->axis = place.axis;
  port->axes = FB_AXES_BODY;
  if (kind == FB_PORT_BASE_VELOCITY || kind == FB_PORT_BASE_RATE) {
    return !place.at[0] ? 0 : fail_port(option, word, "the base has no node");
  }
  port->node = strcmp(place.at, "root") == 0  ? 0
               : strcmp(place.at, "tip") == 0 ? beam_desc.n_element - of_element
                                              : port_number(place.at, count);
  return port->node >= 0 ? 0 : fail_port(option, word, of_element ? "no such element" : "no such node");
}

/* Writes the model of `count` modes about the steady state; a status of main. */
static int write_linear(const options *o, const char *source, int count)
{
  static fb_exact_linear_work work;
  static fb_exact_linear linear;
  static fb_linear_desc desc;
  static linear_value in[FB_MAX_PORTS], out[FB_MAX_PORTS];
  static linear_out file;
  const char *const ins =
      o->inputs ? o->inputs : "force.tip.x,force.tip.y,force.tip.z,torque.tip.x,torque.tip.y,torque.tip.z";
  const char *const outs = o->outputs ? o->outputs
                                      : "displacement.tip.x,displacement.tip.y,displacement.tip.z,"
                                        "internal_moment.root.x,internal_moment.root.y,internal_moment.root.z";
  fb_status status;
  if (read_ports(desc.in, &desc.n_in, in, "--inputs", ins, read_port) ||
      read_ports(desc.out, &desc.n_out, out, "--outputs", outs, read_port)) {
    return 2;
  }
  status = fb_exact_linearize(&beam, &work, &linear, &beam_state, &beam_input, &desc, count);
  if (status != FB_OK) {
    fprintf(stderr, "exact: no linear model: %s\n", refusal_text(status));
    return 1;
  }
  linear_out_exact(&file, source, &linear, &desc, &beam, beam_node, &beam_input);
  return write_ports(&file, in, out, o->linear);
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
  if (output_close(csv, out)) {
    return 2;
  }
  beam_file_name(svg, sizeof svg, out, ".svg");
  plot(svg, "set size ratio -1\nset xlabel ''\n", views, 3, stdout);
  return 0;
}

static int read_option(void *target, const char *name, const char *text)
{
  options *const o = (options *)target;
  const struct {
    const char *name, **text;
  } texts[] = {{"--linear", &o->linear}, {"--inputs", &o->inputs}, {"--outputs", &o->outputs}};
  for (int k = 0; k < 3; k++) {
    if (strcmp(name, texts[k].name) == 0) {
      *texts[k].text = text;
      return 0;
    }
  }
  return strcmp(name, "--out") == 0 ? read_out(&o->out, text) : NO_SUCH_OPTION;
}

int exact_main(int argc, char **argv)
{
  int modes = 0;
  options o = {NULL, NULL, NULL, NULL};
  fb_status status;
  output_begin(PROGRAM);
  if (argc < 2 || strcmp(argv[1], "--help") == 0) {
    fputs(help, argc < 2 ? stderr : stdout);
    return argc < 2 ? 2 : 0;
  }
  if (read_all(argc - 1, argv + 1, help, read_option, &o) != 0 || read_file(argv[1], &modes) != 0) {
    return 2;
  }
  if (!o.linear && (o.inputs || o.outputs)) {
    return fail("--inputs and --outputs are those of --linear FILE", "");
  }
  if (o.out && same_file(argv[1], o.out)) {
    return fail("--out: that is the description itself", o.out);
  }
  if (o.linear && modes == 0) {
    return fail("--linear wants modes: a line modes N", "");
  }
  status = beam_start();
  if (status != FB_OK) {
    fprintf(stderr, "exact: %s: %s\n", argv[1], refusal_text(status));
    return 2;
  }
  status = beam_settle();
  if (status == FB_OK) {
    tell_state();
    status = modes > 0 ? tell_modes(modes) : FB_OK;
    if (status != FB_OK) {
      fprintf(stderr, "exact: modes: %s\n", refusal_text(status));
      return 1;
    }
  } else {
    fprintf(stderr, "exact: no steady state found: %s (%d load increments tried)%s\n", refusal_text(status),
            beam_work.increments,
            status == FB_ERR_SINGULAR
                ? "; is it held against every motion, and the root, not the tip, where it is rigid?"
                : "");
    if (status == FB_ERR_CONVERGENCE && beam_input.n_support > 0) {
      fprintf(stderr,
              "exact: its first element bears a tension of 12 EI/h^2 = %.4g; a slack line of more wants more "
              "elements, or more EI\n",
              exact_bears(&beam, 0));
    }
    return 1;
  }
  if (o.linear) {
    const int bad = write_linear(&o, argv[1], modes);
    if (bad) {
      return bad;
    }
  }
  return o.out ? draw(o.out) : 0;
}
