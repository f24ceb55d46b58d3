/* exact.c - laws of one geometrically exact beam. */
#include "laws.h"

static const fbl_feature features[] = {
    {"base", {"clamped", "moving", "free"}},
    {"elements", {"six", "four", "nine", "twelve"}},
    {"section", {"uniform", "taper", "twist", "centers", "full"}},
    {"curvature", {"straight", "curved", "+coiled"}},
    {"rigid", {"none", "shear", "stretch"}},
    {"rotary", {"inertia", "none"}},
    {"lumps", {"none", "point", "tensor", "several"}},
    {"joint", {"none", "spring", "damper", "motor", "driven", "two", "loose"}},
    {"branch", {"none", "straight", "angled", "two"}},
    {"held", {"root", "slide", "pinned", "tip", "hinged", "+guided"}},
    {"stands", {"origin", "off"}},
    {"load", {"none", "dead", "follower", "base", "line"}},
    {"gravity", {"none", "gravity"}},
    {"dissipation", {"none", "some"}},
    {"newton", {"one", "three"}},
    {"start", {"bent", "straight"}},
    {"waves", {"shared", "box"}},
    {"damping", {"none", "equal", "own"}},
    {"support", {"built", "+moved"}},
};
enum {
  BASE,
  ELEMENTS,
  SECTION,
  CURVATURE,
  RIGID,
  ROTARY,
  LUMPS,
  JOINT,
  BRANCH,
  HELD,
  STANDS,
  LOAD,
  GRAVITY,
  DISSIPATION,
  NEWTON,
  START,
  WAVES,
  DAMPING,
  SUPPORT
};
enum { CLAMPED, MOVING, FREE };
enum { UNIFORM, TAPER, TWIST, CENTERS, FULL };
enum { NO_JOINT, SPRING, DAMPER, MOTOR, DRIVEN, TWO_JOINTS, LOOSE };
enum { NO_BRANCH, IN_LINE, ANGLED, TWO_BRANCHES };
enum { ROOT, SLIDE, PINNED, TIP, HINGED, GUIDED };
enum { NO_LOAD, DEAD, FOLLOWER, OF_BASE, LINE };
enum { LINES = 3, JOINTS = 3 };

static fb_exact_desc desc;
static fb_exact beam;
static fb_exact_state state; /* where the motion starts */
static fb_exact_input input; /* what acts from then on */
static fb_exact_work work;
static int now[FBL_FEATURES];

/* Besides the view: the same beam otherwise. */
static int fine;               /* elements for each one that is drawn */
static int locked;             /* a further joint, driven and at rest, beyond the first element */
static double amplitude = 1.0; /* of what acts, and of the motion of the base */
static int split;              /* the chain ends at its second node, the rest is a branch */

static struct {
  int n[LINES];               /* elements that are drawn: chain, branches; without joints */
  int place[JOINTS], n_joint; /* nodes of the chain that joints are at, ascending; the locked one is the first */
  int n_station;
  double length[LINES], mass, EI, thin, fast; /* fast [s]: of the fastest mode, 1 / omega */
} drawn;

static void legal(int *level)
{
  if (level[BASE] == FREE) {
    level[HELD] = ROOT;
    level[START] = 1; /* no steady state */
  }
  if (level[JOINT] == LOOSE) {
    level[START] = 1;
    level[LOAD] = level[LOAD] == NO_LOAD ? DEAD : level[LOAD];
  }
  if (level[RIGID] == 2 && level[HELD] != ROOT) { /* no length to give */
    level[RIGID] = 1;
  }
  if (level[SECTION] == CENTERS || level[SECTION] == FULL) { /* couple with stretch and shear */
    level[RIGID] = 0;
  }
  if (level[BASE] == FREE && level[CURVATURE] + level[JOINT] == 0 && level[BRANCH] <= IN_LINE && level[LUMPS] < 2) {
    level[ROTARY] = 0; /* nothing says how a straight line turns about itself */
  }
  if (level[HELD] == HINGED && level[JOINT] == LOOSE) {
    level[HELD] = ROOT;
  }
  if (level[HELD] == ROOT || level[START]) { /* nothing that moves; a jump from the undeformed beam */
    level[SUPPORT] = 0;
  }
  if (level[RIGID] == 2 && level[CURVATURE]) { /* rigid in directions that are no axes */
    level[DAMPING] = level[DAMPING] > 0;
  }
  /* nodes with less inertia than directions answer a jump of the load at once, a line that is held twice its stretch:
     bad first guesses */
  if (level[BASE] == FREE || level[JOINT] != NO_JOINT || level[HELD] != ROOT) {
    level[NEWTON] = 1;
  }
}

/* ---- numbering: lines 0 (chain), 1, 2 (branches); places along them in drawn elements */

static int joints_below(int place)
{
  int n = 0;
  for (int j = 0; j < drawn.n_joint; j++) {
    n += drawn.place[j] < place;
  }
  return n;
}

static int chain_size(void)
{
  return drawn.n[0] * fine + drawn.n_joint;
}

/* Branch that comes first in the desc. */
static int first_branch(void)
{
  return drawn.n[1] == 0 || (drawn.n[2] > 0 && fbl_seen.reverse) ? 2 : 1;
}

static int has_attitude(int line)
{
  return line == 2;
}

static int line_size(int line)
{
  return line == 0 ? chain_size() : drawn.n[line] > 0 ? drawn.n[line] * fine + has_attitude(line) : 0;
}

static int line_begin(int line)
{
  return line == 0 ? 0 : chain_size() + (line == first_branch() ? 0 : line_size(3 - line));
}

/* Node at a place: inboard of the joint there; on a branch not its begin. */
static int node_at(int line, int place)
{
  return line == 0 ? place * fine + joints_below(place) : line_begin(line) + has_attitude(line) + place * fine;
}

/* Elements from a place to the next. */
static int element_at(int line, int place, int part)
{
  return line == 0 ? place * fine + part + joints_below(place + 1)
                   : line_begin(line) + has_attitude(line) + place * fine + part;
}

/* ---- sections */

static void matrix_seen(fb_real *A, const double B[36], int kg, int m, int s)
{
  for (int i = 0; i < 36; i++) {
    const int row = i / 6, column = i % 6;
    const double flip = fbl_seen.mirror && (row + column) % 2 ? -1.0 : 1.0;
    A[i] = fbl_unit(flip * B[i], kg, m + row / 3 + column / 3, s);
  }
}

/* Positive definite with any coupling, mass off the line. */
static void section_full(fb_exact_station *station, double factor)
{
  const double EA = drawn.EI / (drawn.thin * drawn.thin);
  const double D[6] = {EA, 0.3 * EA, 0.25 * EA, 0.7 * drawn.EI, drawn.EI, 1.4 * drawn.EI};
  const double y = 0.5 * drawn.thin, z = -0.4 * drawn.thin, m = drawn.mass * factor;
  const double i_y = m * drawn.thin * drawn.thin, i_z = 1.3 * i_y, i_yz = 0.2 * i_y;
  double K[36], M[36] = {0.0};
  for (int i = 0; i < 6; i++) {
    for (int j = 0; j <= i; j++) {
      K[6 * i + j] = K[6 * j + i] = factor * sqrt(D[i] * D[j]) * (i == j ? 1.0 : fbl_in(-0.12, 0.12));
    }
  }
  M[0] = M[7] = M[14] = m;
  M[4] = M[24] = m * z;
  M[5] = M[30] = -m * y;
  M[9] = M[19] = -m * z;
  M[15] = M[20] = m * y;
  M[21] = i_y + i_z + m * (y * y + z * z);
  M[28] = i_y + m * z * z;
  M[35] = i_z + m * y * y;
  M[29] = M[34] = -i_yz - m * y * z;
  matrix_seen(station->stiffness, K, 1, 1, -2);
  matrix_seen(station->inertia, M, 1, -1, 0);
}

static fb_status section_plain(fb_exact_station *station, double factor)
{
  const double EA = factor * drawn.EI / (drawn.thin * drawn.thin), flip = fbl_seen.mirror ? -1.0 : 1.0;
  const double off[6] = {fbl_in(-0.4, 0.4), fbl_in(-0.4, 0.4), fbl_in(-0.4, 0.4),
                         fbl_in(-0.4, 0.4), fbl_in(-0.4, 0.4), fbl_in(-0.4, 0.4)};
  const double wide = fbl_in(0.7, 1.6);
  fb_section s;
  memset(&s, 0, sizeof s);
  s.mass = fbl_unit(factor * drawn.mass, 1, -1, 0);
  s.EI_y = fbl_unit(factor * drawn.EI * wide, 1, 3, -2);
  s.EI_z = fbl_unit(factor * drawn.EI, 1, 3, -2);
  s.GJ = fbl_unit(0.7 * factor * drawn.EI, 1, 3, -2);
  s.EA = now[RIGID] == 2 ? FB_R(0.0) : fbl_unit(EA, 1, 1, -2);
  if (now[RIGID] == 0) {
    s.GA_y = fbl_unit(0.3 * EA, 1, 1, -2);
    s.GA_z = fbl_unit(0.25 * EA, 1, 1, -2);
  }
  if (now[ROTARY] == 0) {
    s.i_y = fbl_unit(factor * drawn.mass * drawn.thin * drawn.thin, 1, 1, 0);
    s.i_z = fbl_unit(1.3 * factor * drawn.mass * drawn.thin * drawn.thin, 1, 1, 0);
  }
  if (now[SECTION] == CENTERS) {
    s.mass_y = fbl_unit(flip * off[0] * drawn.thin, 0, 1, 0);
    s.mass_z = fbl_unit(off[1] * drawn.thin, 0, 1, 0);
    s.tension_y = fbl_unit(flip * off[2] * drawn.thin, 0, 1, 0);
    s.tension_z = fbl_unit(off[3] * drawn.thin, 0, 1, 0);
    s.shear_y = fbl_unit(flip * off[4] * drawn.thin, 0, 1, 0);
    s.shear_z = fbl_unit(off[5] * drawn.thin, 0, 1, 0);
  }
  return fb_exact_station_init(station, &s);
}

/* At a part (0..1) of a line; x [m] from where its stations begin. */
static fb_status station_draw(double part, double x)
{
  const double factor = now[SECTION] == TAPER || now[SECTION] == FULL ? 1.0 - 0.5 * part : 1.0;
  fb_exact_station *const at = &desc.station[drawn.n_station];
  fb_status status = FB_OK;
  double bow[3];
  memset(at, 0, sizeof *at);
  fbl_stream("section");
  if (now[SECTION] == FULL) {
    section_full(at, factor);
  } else {
    status = section_plain(at, factor);
  }
  at->x = fbl_unit(x, 0, 1, 0);
  at->twist = (fb_real)(now[SECTION] == TWIST ? (fbl_seen.mirror ? -0.8 : 0.8) * part : 0.0);
  fbl_stream("bow");
  for (int i = 0; i < 3; i++) {
    bow[i] = now[CURVATURE] ? fbl_in(-0.5, 0.5) * (now[CURVATURE] > 1 ? 8.0 : 1.0) / drawn.length[0] : 0.0;
  }
  fbl_axial(at->curvature, bow[0], bow[1], bow[2], 0, -1, 0);
  drawn.n_station++;
  return status;
}

/* Two stations from one part of the chain to another. */
static fb_status stations_draw(double from, double to, double length)
{
  const fb_status status = station_draw(from, 0.0);
  return status ? status : station_draw(to, length);
}

/* ---- the beam */

static void joint_draw(int j, int place, int kind, const char *use)
{
  fb_exact_joint *const joint = &desc.joint[j];
  const double stiff = drawn.EI / drawn.length[0];
  double a[3], size = 0.0, angle, rest, rate, k, c;
  fbl_stream(use);
  for (int i = 0; i < 3; i++) {
    a[i] = fbl_in(-0.4, 0.4) + (i == 2);
    size += a[i] * a[i];
  }
  angle = fbl_in(-0.4, 0.4);
  rest = angle + (now[START] ? 0.0 : 0.3) * fbl_in(-1.0, 1.0); /* undeformed: no jump at the start */
  rate = amplitude * fbl_in(-1.0, 1.0);
  k = fbl_in(1.0, 4.0) * stiff;
  c = fbl_in(0.02, 0.1) * stiff;
  fbl_axial(joint->axis, a[0] / sqrt(size), a[1] / sqrt(size), a[2] / sqrt(size), 0, 0, 0);
  joint->element = node_at(0, place);
  joint->driven = kind == DRIVEN;
  joint->angle = (fb_real)angle;
  joint->rest = (fb_real)rest;
  joint->rate = now[START] ? fbl_unit(rate, 0, 0, -1) : FB_R(0.0);
  joint->stiffness = kind == DRIVEN || kind == LOOSE ? FB_R(0.0) : fbl_unit(k, 1, 2, -2);
  joint->damping = kind == DAMPER ? fbl_unit(c, 1, 2, -1) : FB_R(0.0);
}

static void joints_draw(void)
{
  const int flip = fbl_seen.reverse && now[JOINT] == TWO_JOINTS;
  int j = locked;
  desc.n_joint = drawn.n_joint;
  if (locked) {
    fb_exact_joint *const joint = &desc.joint[drawn.n_joint - 1]; /* the others keep their numbers */
    memset(joint, 0, sizeof *joint);
    joint->element = node_at(0, drawn.place[0]);
    joint->driven = 1;
    fbl_axial(joint->axis, 0.36, 0.48, 0.8, 0, 0, 0);
  }
  if (now[JOINT] == TWO_JOINTS) {
    joint_draw(flip, drawn.place[j], SPRING, "joint 1");
    joint_draw(!flip, drawn.place[j + 1], DRIVEN, "joint 2");
  } else if (now[JOINT] != NO_JOINT) {
    joint_draw(0, drawn.place[j], now[JOINT], "joint 1");
  }
}

static void lump_draw(int k, int node)
{
  fb_lump *const lump = &desc.lump[fbl_seen.reverse ? desc.n_lump - 1 - k : k];
  const double reach = drawn.thin * 0.8, flip = fbl_seen.mirror ? -1.0 : 1.0;
  const double mass = fbl_in(0.1, 0.4) * drawn.mass * drawn.length[0];
  double center[3], moment[3], tilt[3];
  for (int i = 0; i < 3; i++) {
    center[i] = fbl_in(-reach, reach);
    moment[i] = mass * reach * reach * fbl_in(0.5, 0.9);
    tilt[i] = 0.3 * mass * reach * reach * fbl_in(-0.3, 0.3);
  }
  memset(lump, 0, sizeof *lump);
  lump->node = node;
  lump->mass = fbl_unit(mass, 1, 0, 0);
  if (now[LUMPS] >= 2) {
    fbl_polar(lump->center, center[0], center[1], center[2], 0, 1, 0);
    for (int i = 0; i < 3; i++) {
      lump->inertia[i] = fbl_unit(moment[i], 1, 2, 0);
      lump->inertia[3 + i] = fbl_unit((i == 1 ? 1.0 : flip) * tilt[i], 1, 2, 0);
    }
  }
}

static void lumps_draw(void)
{
  fbl_stream("lumps");
  desc.n_lump = now[LUMPS] == 0 ? 0 : now[LUMPS] == 3 ? 3 : 1;
  for (int k = 0; k < desc.n_lump; k++) {
    lump_draw(k, node_at(k == 2 && drawn.n[1] ? 1 : 0, k == 0 ? drawn.n[0] : k == 1 ? 1 : 2));
  }
}

static fb_status branch_draw(int line, int index)
{
  fb_exact_branch *const branch = &desc.branch[index];
  memset(branch, 0, sizeof *branch);
  branch->node = node_at(0, line == 1 ? 2 : drawn.n[0]);
  branch->n_element = line_size(line);
  branch->length = fbl_unit(drawn.length[line], 0, 1, 0);
  branch->station = drawn.n_station;
  branch->n_station = 2;
  if (has_attitude(line)) {
    static const double q[4] = {0.8, 0.3, -0.4, 0.33};
    fbl_quat(branch->attitude, q, 0);
  }
  return stations_draw(0.0, 1.0, drawn.length[line]);
}

static fb_status lines_draw(void)
{
  const double at = split ? 2.0 / drawn.n[0] : 1.0, length = drawn.length[0];
  fb_status status;
  drawn.n_station = 0;
  status = stations_draw(0.0, at, at * length);
  desc.n_station = drawn.n_station;
  desc.length = fbl_unit(at * length, 0, 1, 0);
  desc.n_element = split ? node_at(0, 2) : chain_size();
  if (split && status == FB_OK) {
    fb_exact_branch *const branch = &desc.branch[desc.n_branch++];
    memset(branch, 0, sizeof *branch);
    branch->node = desc.n_element;
    branch->n_element = chain_size() - desc.n_element;
    branch->length = fbl_unit((1.0 - at) * length, 0, 1, 0);
    branch->station = 2;
    branch->n_station = 2;
    status = stations_draw(at, 1.0, (1.0 - at) * length);
  }
  for (int k = 0, line = first_branch(); k < 2 && status == FB_OK; k++, line = 3 - line) {
    if (drawn.n[line] > 0) {
      status = branch_draw(line, desc.n_branch++);
    }
  }
  return status;
}

static void supports_draw(void)
{
  static const int held[] = {0, FB_HOLD_Y, FB_END_PINNED, FB_HOLD_Y | FB_HOLD_Z,
                             FB_END_PINNED | FB_HOLD_RX | FB_HOLD_RZ};
  desc.root = now[BASE] == FREE ? FB_END_FREE : now[HELD] == HINGED ? FB_END_CLAMPED & ~FB_HOLD_RZ : FB_END_CLAMPED;
  if (now[HELD] == GUIDED) { /* the root gives way along the beam, which is held there beyond it */
    desc.root = FB_END_SLIDING;
    desc.n_support = 1;
    desc.support[0].node = node_at(0, 2);
    desc.support[0].held = FB_HOLD_X;
  } else if (now[HELD] != ROOT) {
    desc.n_support = 1;
    desc.support[0].node = node_at(0, now[HELD] == TIP ? drawn.n[0] : now[HELD] == HINGED ? 1 : 2);
    desc.support[0].held = held[now[HELD]];
  }
}

static void sizes_draw(void)
{
  static const int elements[] = {6, 4, 9, 12};
  double bend, pace;
  fbl_stream("sizes");
  drawn.n[0] = elements[now[ELEMENTS]];
  drawn.n[1] = now[BRANCH] == IN_LINE || now[BRANCH] == TWO_BRANCHES ? 2 : 0;
  drawn.n[2] = now[BRANCH] == ANGLED || now[BRANCH] == TWO_BRANCHES ? 3 : 0;
  drawn.length[0] = fbl_in(1.0, 4.0);
  drawn.length[1] = fbl_in(0.3, 0.5) * drawn.length[0];
  drawn.length[2] = fbl_in(0.3, 0.6) * drawn.length[0];
  drawn.mass = fbl_in(0.5, 3.0);
  drawn.thin = fbl_in(0.02, 0.05) * drawn.length[0];
  bend = fbl_in(3.0, 12.0) * drawn.length[0] * drawn.length[0] / 3.516;
  drawn.EI = bend * bend * drawn.mass;
  pace = sqrt(drawn.EI / drawn.mass) / drawn.thin; /* of stretch waves */
  drawn.fast =
      (drawn.thin < 0.5 * drawn.length[0] / drawn.n[0] ? drawn.thin : 0.5 * drawn.length[0] / drawn.n[0]) / pace;
  drawn.n_joint = 0;
  if (locked) {
    drawn.place[drawn.n_joint++] = 1;
  }
  if (now[JOINT] != NO_JOINT) {
    drawn.place[drawn.n_joint++] = drawn.n[0] / 2;
  }
  if (now[JOINT] == TWO_JOINTS) {
    drawn.place[drawn.n_joint++] = drawn.n[0] / 2 + 1;
  }
}

static fb_status beam_draw(void)
{
  static const double q[4] = {0.7, 0.5, -0.1, 0.5};
  const double sag = drawn.EI / (drawn.mass * pow(drawn.length[0], 3.0));
  fb_status status;
  memset(&desc, 0, sizeof desc);
  status = lines_draw();
  joints_draw();
  lumps_draw();
  supports_draw();
  fbl_stream("stands");
  if (now[STANDS]) {
    const double x = fbl_in(-0.5, 0.5), y = fbl_in(-0.5, 0.5), z = fbl_in(-0.5, 0.5);
    fbl_polar(desc.position, x * drawn.length[0], y * drawn.length[0], z * drawn.length[0], 0, 1, 0);
    fbl_quat(desc.attitude, q, 0);
  }
  if (now[GRAVITY]) {
    fbl_inertial_polar(desc.gravity, 0.2 * sag, -0.3 * sag, 0.4 * sag, 0, 1, -2);
  }
  desc.dissipation = now[DISSIPATION] ? FB_R(0.3) : FB_R(0.0);
  fbl_stream("damping");
  for (int i = 0; i < 6 && now[DAMPING]; i++) {
    const double mu = fbl_in(0.001, 0.01);
    desc.damping[i] = now[DAMPING] == 1 && i > 0 ? desc.damping[0] : fbl_unit(mu, 0, 0, 1);
  }
  desc.box = now[WAVES];
  desc.iterations = 10;
  desc.factorizations = now[NEWTON] ? 3 : 1;
  return status ? status : fb_exact_init(&beam, &desc);
}

/* ---- what acts */

static void vector_draw(double v[3], double size)
{
  for (int i = 0; i < 3; i++) {
    v[i] = fbl_in(-size, size);
  }
}

static void wrench_draw(fb_real *force, fb_real *torque, fb_axes axes, double f, double t, int per_length)
{
  double x[3], y[3];
  vector_draw(x, f);
  vector_draw(y, t);
  if (axes == FB_AXES_INERTIAL) {
    fbl_inertial_polar(force, x[0], x[1], x[2], 1, 1 - per_length, -2);
    fbl_inertial_axial(torque, y[0], y[1], y[2], 1, 2 - per_length, -2);
  } else {
    fbl_polar(force, x[0], x[1], x[2], 1, 1 - per_length, -2);
    fbl_axial(torque, y[0], y[1], y[2], 1, 2 - per_length, -2);
  }
}

static void load_add(int k, int count, int node, fb_axes axes, double f)
{
  fb_load *const load = &input.load[input.n_load + (fbl_seen.reverse ? count - 1 - k : k)];
  load->node = node;
  load->axes = axes;
  wrench_draw(load->force, load->torque, axes, f, 0.3 * f * drawn.length[0], 0);
}

static int extra_node(void) /* a second place for loads: on a branch if there is one */
{
  return drawn.n[2] ? node_at(2, 2) : drawn.n[1] ? node_at(1, 1) : node_at(0, drawn.n[0] / 2);
}

static void input_draw(void)
{
  static const fb_axes axes[] = {FB_AXES_INERTIAL, FB_AXES_INERTIAL, FB_AXES_NODE, FB_AXES_BODY};
  const double unit = amplitude * drawn.EI / (drawn.length[0] * drawn.length[0]);
  double v[3], w[3];
  memset(&input, 0, sizeof input);
  fbl_stream("load");
  if (now[LOAD] == LINE) {
    for (int line = 0; line < LINES; line++) {
      for (int place = 0; place < drawn.n[line]; place++) {
        fb_line_load load;
        load.axes = place % 2 ? FB_AXES_NODE : FB_AXES_BODY;
        wrench_draw(load.force, load.torque, load.axes, 0.4 * unit / drawn.length[0], 0.1 * unit, 1);
        for (int part = 0; part < fine; part++) {
          input.line[element_at(line, place, part)] = load;
        }
      }
    }
  } else if (now[LOAD] != NO_LOAD) {
    for (int k = 0; k < 2; k++) {
      load_add(k, 2, k ? extra_node() : node_at(0, drawn.n[0]), axes[now[LOAD]], 0.3 * unit);
    }
    input.n_load = 2;
  }
  fbl_stream("motion");
  vector_draw(v, amplitude * 0.5 * drawn.length[0]);
  vector_draw(w, amplitude * 1.5);
  if (now[BASE] != CLAMPED) {
    fbl_polar(input.v, v[0], v[1], v[2], 0, 1, -1);
    fbl_axial(input.w, w[0], w[1], w[2], 0, 0, -1);
  }
  fbl_stream("support");
  if (now[SUPPORT]) {
    const int held = desc.support[0].held;
    vector_draw(v, amplitude * 2e-3 * drawn.length[0]);
    input.n_support = 1;
    input.support[0].node = desc.support[0].node;
    fbl_polar(input.support[0].displacement, held & FB_HOLD_X ? v[0] : 0.0, held & FB_HOLD_Y ? v[1] : 0.0,
              held & FB_HOLD_Z ? v[2] : 0.0, 0, 1, 0);
  }
  fbl_stream("motor");
  if (now[JOINT] == MOTOR || now[JOINT] == LOOSE) {
    input.motor[0] = fbl_unit(fbl_in(-0.2, 0.2) * unit * drawn.length[0], 1, 2, -2);
  } else if ((now[JOINT] == DRIVEN || now[JOINT] == TWO_JOINTS) && now[START]) {
    input.motor[now[JOINT] == TWO_JOINTS && !fbl_seen.reverse] = fbl_unit(amplitude * fbl_in(-0.5, 0.5), 0, 0, -1);
  }
}

/* Bent by loads that are then gone, at rest in the frame of its base; or undeformed, in rigid motion. */
static fb_status state_draw(void)
{
  static const double q[4] = {0.5, -0.5, 0.1, 0.7};
  const double unit = drawn.EI / (drawn.length[0] * drawn.length[0]);
  fb_status status = fb_exact_state_init(&beam, &state, &work, &input);
  fbl_quat(state.base_quat, q, 1);
  {
    fb_real boost[3], u[3], R[9];
    fb_quat_to_mat33(R, state.base_quat);
    fb_mat33_mul_vec3(u, R, state.u);
    fbl_inertial_polar(boost, fbl_seen.boost[0], fbl_seen.boost[1], fbl_seen.boost[2], 0, 1, -1);
    for (int i = 0; i < 3; i++) {
      state.u[i] = u[i] + boost[i];
      state.base_position[i] = fbl_unit(fbl_seen.shift[i], 0, 1, 0);
    }
  }
  if (now[START] == 0 && status == FB_OK) {
    const fb_exact_input later = input;
    fbl_stream("pluck");
    load_add(0, 1, node_at(0, drawn.n[0]), FB_AXES_BODY, 0.5 * unit);
    input.n_load++;
    status = fb_exact_trim(&beam, &state, &work, &input);
    input = later;
  }
  return status;
}

static fb_status draw_as(int elements, int with_joint, int in_parts)
{
  fb_status status;
  fine = elements;
  locked = with_joint;
  split = in_parts;
  sizes_draw();
  status = beam_draw();
  input_draw();
  return status ? status : state_draw();
}

static fb_status draw(const int *level)
{
  amplitude = 1.0;
  memcpy(now, level, sizeof now);
  return draw_as(1, 0, 0);
}

/* The drawn model with other levels of two features, and of its loads: for laws that want it simpler. */
static fb_status draw_simpler(int base, int dissipation, int start, const int *loads)
{
  now[BASE] = base >= 0 ? base : now[BASE];
  now[DISSIPATION] = dissipation >= 0 ? dissipation : now[DISSIPATION];
  now[START] = start >= 0 ? start : now[START];
  now[LOAD] = loads ? loads[now[LOAD]] : now[LOAD];
  now[GRAVITY] = 0;
  legal(now);
  return draw_as(1, 0, 0);
}

/* ---- what can be asked of a state */

typedef struct look {
  fb_exact_state state;
  fb_exact_node node[FB_MAX_EXACT + 1];
  fb_exact_element element[FB_MAX_EXACT];
  fb_exact_hinge hinge[FB_MAX_LUMPS];
  fb_energy energy;
  fb_momentum momentum;
} look;

static fb_status look_at(look *at, const fb_exact_state *where)
{
  fb_status status = fb_exact_nodes_eval(&beam, at->node, where);
  at->state = *where;
  for (int k = 0; k < beam.n && status == FB_OK; k++) {
    status = fb_exact_element_eval(&beam, &at->element[k], where, k);
  }
  for (int j = 0; j < beam.n_joint && status == FB_OK; j++) {
    status = fb_exact_joint_eval(&beam, &at->hinge[j], where, j);
  }
  status = status ? status : fb_exact_energy_eval(&beam, &at->energy, where);
  return status ? status : fb_exact_momentum_eval(&beam, &at->momentum, where);
}

static fb_status steps(fb_exact_state *at, int count, double dt)
{
  fb_status status = FB_OK;
  for (int k = 0; k < count && status == FB_OK; k++) {
    status = fb_exact_step(&beam, at, &work, &input, (fb_real)dt);
  }
  return status;
}

/* Attitude in the middle between two. */
static void quat_between(fb_real q[4], const fb_real a[4], const fb_real b[4])
{
  double sign = 0.0;
  for (int i = 0; i < 4; i++) {
    sign += (double)a[i] * (double)b[i];
  }
  for (int i = 0; i < 4; i++) {
    q[i] = sign < 0.0 ? a[i] - b[i] : a[i] + b[i];
  }
  (void)fb_quat_normalize(q);
}

/* Scales of what is compared, as seen. */
static double length_of(void)
{
  return (double)fbl_unit(drawn.length[0], 0, 1, 0);
}

static double speed_of(void)
{
  return (double)fbl_unit(drawn.length[0], 0, 1, -1);
}

static double force_of(void)
{
  return (double)fbl_unit(drawn.EI / (drawn.length[0] * drawn.length[0]), 1, 1, -2);
}

/* dt [s] of the drawn unit of time */
static double step_of(double h)
{
  return h * drawn.fast;
}

/* Two states a step apart, some steps after the start. h: the step over the time of the fastest mode. */
static look before, after;
static double dt;

static fb_status walk(double h, int count)
{
  fb_exact_state at = state;
  fb_status status;
  dt = step_of(h);
  status = steps(&at, count, dt);
  status = status ? status : look_at(&before, &at);
  status = status ? status : steps(&at, 1, dt);
  return status ? status : look_at(&after, &at);
}

/* Velocity, angular rate and axes of a node in the middle of the step from `before` to `after`, inertial. The velocity u
   of the frame is in the axes of the end (flexbeam.h), all else in those of the middle. */
static void node_middle(fb_real v[3], fb_real w[3], fb_real q[4], int k)
{
  const fb_exact_node *const b = &after.node[k];
  fb_real R[9], u[3], own[3];
  for (int i = 0; i < 3; i++) {
    u[i] = after.state.u[i] - (now[BASE] == FREE ? FB_R(0.5) * desc.gravity[i] * (fb_real)dt : FB_R(0.0));
  }
  fb_quat_to_mat33(R, b->quat);
  fb_mat33_mulT_vec3(own, R, u);
  for (int i = 0; i < 3; i++) {
    own[i] = b->velocity[i] - own[i];
  }
  quat_between(q, before.node[k].quat, b->quat);
  to_inertial(v, q, own);
  to_inertial(w, q, b->angular_rate);
  for (int i = 0; i < 3; i++) {
    v[i] += u[i];
  }
}

/* A law that holds but for what an element turns, of order 4: asked of elements half as long where it misses. */
static double by_mesh(double (*miss)(double h), double h, double bound)
{
  const double coarse = miss(h);
  double finer;
  if (coarse <= bound) {
    return coarse;
  }
  {
    const fb_status status = draw_as(2, 0, 0);
    if (status != FB_OK) {
      return fbl_refuse("finer", status);
    }
  }
  finer = miss(h);
  return finer >= 0.0 && finer < coarse / 8.0 ? 0.0 : finer;
}

/* ---- laws: derivatives */

static double velocities_of(double h)
{
  double miss = 0.0;
  FBL_TRY(walk(h, now[DISSIPATION] ? 40 : 4)); /* it takes of a rate what changes from step to step, all in the first */
  for (int k = 0; k <= beam.n; k++) {
    const fb_exact_node *const a = &before.node[k], *const b = &after.node[k];
    const fb_real back[4] = {a->quat[0], -a->quat[1], -a->quat[2], -a->quat[3]};
    fb_real q[4], v[3], turn[4], w[3];
    node_middle(v, w, q, k);
    fb_quat_mul(turn, back, b->quat);
    fb_quat_to_rotvec(w, turn);
    for (int i = 0; i < 3; i++) {
      miss = larger(miss, fabs(((double)b->position[i] - (double)a->position[i]) / dt - (double)v[i]) /
                              (fbl_largest(v, 3) + 0.1 * speed_of()));
      miss =
          larger(miss, fabs((double)w[i] / dt - (double)b->angular_rate[i]) / (fbl_largest(b->angular_rate, 3) + 0.1));
    }
  }
  return miss;
}

static double velocities(double h)
{
  if (now[ROTARY]) { /* rotations without inertia ring at once, whatever the step */
    return FBL_NONE;
  }
  return by_mesh(velocities_of, h, 3e-5);
}

static double joint_rates(double h)
{
  double miss = 0.0;
  if (beam.n_joint == 0) {
    return FBL_NONE;
  }
  FBL_TRY(walk(h, 4));
  for (int j = 0; j < beam.n_joint; j++) {
    const fb_exact_hinge *const b = &after.hinge[j];
    const fb_exact_node *const in = &after.node[beam.inboard[beam.joint[j].element]],
                               *const out = &after.node[beam.joint[j].element + 1];
    const double rate = ((double)b->angle - (double)before.hinge[j].angle) / dt,
                 w = dot(out->angular_rate, beam.joint[j].axis) - dot(in->angular_rate, beam.joint[j].axis);
    miss = larger(miss, fabs(rate - (double)b->rate) / (fabs(rate) + 0.1));
    miss = larger(miss, fabs(w - (double)b->rate) / (fbl_largest(in->angular_rate, 3) + 0.1));
    if (j < desc.n_joint && !desc.joint[j].driven && !now[DISSIPATION]) { /* which moves the middle of the step */
      const double bend = 0.5 * ((double)before.hinge[j].angle + (double)b->angle) - (double)desc.joint[j].rest;
      const double moment = (double)input.motor[j] - (double)desc.joint[j].stiffness * bend -
                            (double)desc.joint[j].damping * (double)b->rate;
      miss = larger(miss, fabs(moment - (double)b->moment) / (force_of() * length_of()));
    }
    for (int i = 0; i < 3; i++) {
      miss = larger(miss, fabs((double)in->position[i] - (double)out->position[i]) / length_of());
    }
  }
  return miss;
}

/* ---- laws: energy */

/* In the box scheme the mass of a curved element differs between its axes, and a velocity u of the frame is as steady as
   momentum alone: a base that moves, or none, then makes power of its own, as the header says of `box`. */
static int drifts(void)
{
  return now[WAVES] && now[BASE] != CLAMPED && (now[CURVATURE] || now[SECTION] >= TWIST);
}

static double joint_power(double *size)
{
  double sum = 0.0;
  for (int j = 0; j < beam.n_joint; j++) {
    const fb_exact_joint *const joint = j < desc.n_joint ? &desc.joint[j] : &beam.joint[j];
    const double rate = (double)after.hinge[j].rate;
    const double power = joint->driven ? (double)after.hinge[j].moment * rate
                                       : ((double)input.motor[j] - (double)joint->damping * rate) * rate;
    sum += power;
    *size += fabs(power);
  }
  return sum;
}

/* E10.29: h strain_t.D strain_t of the elements. */
static double damping_power(void)
{
  double sum = 0.0;
  for (int i = 0; i < 36 * beam.n; i++) {
    const int k = i / 36, a = i / 6 % 6, b = i % 6;
    const fb_real *const rate = after.state.strain_rate + 6 * k, *const root = beam.damping;
    sum +=
        (double)beam.h[k] * (double)rate[a] * (double)root[a] * (double)beam.S[i] * (double)root[b] * (double)rate[b];
  }
  return sum * (double)beam.force * (double)beam.length / (double)beam.time;
}

/* Power of loads, of damping and of what holds the nodes in the middle of the step from `before` to `after`. */
static double power_of(double *size)
{
  const double lost = damping_power();
  double sum = joint_power(size) - lost;
  *size += lost;
  for (int l = 0; l < input.n_load; l++) {
    const fb_load *const load = &input.load[l];
    fb_real q[4], v[3], w[3], f[3], t[3];
    node_middle(v, w, q, load->node);
    memcpy(f, load->force, sizeof f);
    memcpy(t, load->torque, sizeof t);
    if (load->axes == FB_AXES_BODY) {
      quat_between(q, before.state.base_quat, after.state.base_quat);
    }
    if (load->axes != FB_AXES_INERTIAL) {
      to_inertial(f, q, load->force);
      to_inertial(t, q, load->torque);
    }
    sum += dot(f, v) + dot(t, w);
    *size += fabs(dot(f, v)) + fabs(dot(t, w));
  }
  for (int k = 0; k <= beam.n; k++) {
    fb_real q[4], v[3], w[3], f[3], t[3];
    node_middle(v, w, q, k);
    to_inertial(f, q, after.node[k].reaction_force);
    to_inertial(t, q, after.node[k].reaction_moment);
    sum += dot(f, v) + dot(t, w);
    *size += fabs(dot(f, v)) + fabs(dot(t, w));
  }
  return sum;
}

static double total(const fb_energy *e)
{
  return (double)e->kinetic + (double)e->strain + (double)e->gravity;
}

/* The energy of a beam that nothing works on, or gravity, follower loads and joints alone, whatever the step: exactly. Only
   where the base rests. */
static double energy_of_long_steps(double h)
{
  static const int loads[] = {NO_LOAD, FOLLOWER, FOLLOWER, NO_LOAD, NO_LOAD};
  double size = 0.0, power;
  (void)h;
  now[BASE] = CLAMPED;
  now[DISSIPATION] = 0;
  now[LOAD] = loads[now[LOAD]];
  now[GRAVITY] = FB_SINGLE ? 0 : now[GRAVITY]; /* its potential rounds by more than a beam at rest moves */
  legal(now);
  FBL_TRY(draw_as(1, 0, 0));
  if ((now[RIGID] == 2 || now[ROTARY]) &&
      now[JOINT] == LOOSE) { /* the last correction shows: the iteration contracts slowly */
    return FBL_NONE;
  }
  if (now[ROTARY] && now[GRAVITY]) { /* rotations without inertia ring from step to step by more than E11.56 takes */
    return FBL_NONE;
  }
  beam.iterations = 20;
  FBL_TRY(walk(0.7, 8));
  power = power_of(&size);
  return fabs(total(&after.energy) - total(&before.energy) - power * dt) /
         (size * dt + (double)after.energy.kinetic + (double)after.energy.strain + 1e-300);
}

static double energy_rate(double h)
{
  double size = 0.0, power;
  FBL_TRY(walk(h, 6));
  power = power_of(&size);
  return fabs((total(&after.energy) - total(&before.energy)) / dt - power) /
         (size + ((double)after.energy.kinetic + (double)after.energy.strain) / (double)fbl_unit(1.0, 0, 0, 1) +
          1e-300);
}

/* Gravity is left out: its energy has the bend within an element by its loads, which rings with the fastest mode. */
static double energy_changes_by_power(double h)
{
  static const int loads[] = {NO_LOAD, DEAD, FOLLOWER, OF_BASE, DEAD};
  if (drifts() || now[ROTARY]) { /* rotations without inertia ring at once */
    return FBL_NONE;
  }
  FBL_TRY(draw_simpler(-1, 0, -1, loads));
  return by_mesh(energy_rate, h, 3e-5);
}

/* With dissipation the energy that the step knows never rises. */
static double dissipation_takes(double h)
{
  static const int loads[] = {NO_LOAD, NO_LOAD, NO_LOAD, NO_LOAD, NO_LOAD};
  double last, most = 0.0;
  fb_exact_state at;
  (void)h;
  if (now[JOINT] >= MOTOR) { /* they drive */
    return FBL_NONE;
  }
  FBL_TRY(draw_simpler(CLAMPED, 1, -1, loads));
  at = state;
  FBL_TRY(steps(&at, 1, step_of(2.0))); /* what the step keeps of the one before begins with the first */
  FBL_TRY(look_at(&before, &at));
  last = total(&before.energy);
  for (int k = 0; k < 8; k++) {
    FBL_TRY(steps(&at, 1, step_of(2.0)));
    FBL_TRY(look_at(&after, &at));
    most = larger(most, total(&after.energy) - last);
    last = total(&after.energy);
  }
  return most / (total(&before.energy) + 1e-300);
}

/* Free flight keeps momentum and angular momentum to what flexbeam.h says of the mesh and the step: a bound that is to
   shrink when the step keeps them. */
static double flight_keeps_momentum(double h)
{
  static const int loads[] = {NO_LOAD, NO_LOAD, NO_LOAD, NO_LOAD, NO_LOAD};
  fb_exact_state at;
  double p, turning;
  if (now[BASE] != FREE) {
    return FBL_NONE;
  }
  now[JOINT] = now[CURVATURE] = now[ROTARY] = 0;
  now[SECTION] = now[SECTION] >= TWIST ? UNIFORM : now[SECTION];
  FBL_TRY(draw_simpler(FREE, -1, 1, loads));
  at = state;
  FBL_TRY(look_at(&before, &at));
  FBL_TRY(steps(&at, 60, step_of(h)));
  FBL_TRY(look_at(&after, &at));
  p = fbl_largest(before.momentum.linear, 3);
  turning = fbl_largest(before.momentum.angular, 3) + p * length_of();
  return larger(fbl_difference(before.momentum.linear, after.momentum.linear, 3) / p,
                fbl_difference(before.momentum.angular, after.momentum.angular, 3) / turning);
}

/* ---- laws: the same scene seen otherwise */

static int line_of_node(int node, int *place)
{
  int line = 0;
  for (int k = 1; k < LINES; k++) {
    line = drawn.n[k] && node > line_begin(k) && node <= line_begin(k) + line_size(k) ? k : line;
  }
  *place = node - line_begin(line);
  return line;
}

enum { STEPS = 20 };

/* A vector of the plain scene as it is seen, its unit kg^kg m^m s^s. */
static void seen(fb_real out[3], const fb_real *x, int axial, int kg, int m, int s)
{
  (axial ? fbl_axial : fbl_polar)(out, (double)x[0], (double)x[1], (double)x[2], kg, m, s);
}

static double over(const fb_real *a, const fb_real *b, double unit)
{
  return fbl_difference(a, b, 3) / (unit + fbl_largest(a, 3));
}

/* Outputs of an element, by the vectors in it, in their order. Velocities are those of momenta: without rotary inertia rounding
   moves them. */
static double elements_differ(const fb_exact_element *a, const fb_exact_element *b)
{
  static const int unit[8][3] = {{1, 1, -2}, {1, 2, -2}, {0, 0, 0},  {0, -1, 0},
                                 {0, 1, -1}, {0, 0, -1}, {1, 0, -1}, {1, 1, -1}}; /* kg, m, s */
  const double l = drawn.length[0], f = drawn.EI / (l * l), size[8] = {f, f * l, 1e-3, 1.0 / l, l, 1.0, f / l, f};
  const fb_real *const p = (const fb_real *)a, *const q = (const fb_real *)b;
  double miss = 0.0;
  for (int i = 0; i < 8; i++) {
    const int kg = unit[i][0], m = unit[i][1], s = unit[i][2], unsure = now[ROTARY] && i / 2 == 2;
    fb_real x[3];
    seen(x, p + 3 * i, i % 2, kg, m, s);
    miss = larger(miss, unsure ? 0.0 : over(x, q + 3 * i, (double)fbl_unit(size[i], kg, m, s)));
  }
  return 0.01 * miss;
}

/* Largest difference of the two over the size of the motion; the second as fbl_seen has it. Nodes of the first are
   numbered as the plain scene has them. map: node of the second for that of the first. */
static double looks_differ(const look *a, const look *b, int n, const int *map)
{
  double miss = 0.0;
  for (int k = 0; k <= n; k++) {
    const fb_exact_node *const p = &a->node[k], *const q = &b->node[map[k]];
    fb_real x[3];
    fbl_inertial_polar(x, (double)p->position[0], (double)p->position[1], (double)p->position[2], 0, 1, 0);
    for (int i = 0; i < 3; i++) {
      miss = larger(miss, fabs((double)q->position[i] - (double)x[i] - (double)fbl_unit(fbl_seen.shift[i], 0, 1, 0)) /
                              length_of());
    }
    seen(x, p->velocity, 0, 0, 1, -1);
    miss = larger(miss, over(x, q->velocity, speed_of()));
    seen(x, p->angular_rate, 1, 0, 0, -1);
    miss = larger(miss, over(x, q->angular_rate, (double)fbl_unit(1.0, 0, 0, -1)));
    seen(x, p->displacement, 0, 0, 1, 0);
    miss = larger(miss, fbl_difference(q->displacement, x, 3) / length_of());
    seen(x, p->force, 0, 1, 1, -2);
    miss = larger(miss, 0.01 * over(x, q->force, force_of()));
    seen(x, p->moment, 1, 1, 2, -2);
    miss = larger(miss, 0.01 * over(x, q->moment, force_of() * length_of()));
    miss = larger(miss, k < n ? elements_differ(&a->element[k], &b->element[map[k + 1] - 1]) : 0.0);
  }
  for (int j = 0; j < desc.n_joint - locked; j++) {
    const int other = fbl_seen.reverse && now[JOINT] == TWO_JOINTS ? 1 - j : j;
    const fb_exact_hinge *const p = &a->hinge[j], *const q = &b->hinge[other];
    const double unit = force_of() * length_of(), moment = (double)fbl_unit((double)p->moment, 1, 2, -2);
    miss = larger(miss, fabs((double)q->angle - (double)p->angle));
    miss = larger(miss, 0.01 * fabs((double)q->moment - moment) / (unit + fabs(moment)));
  }
  return larger(miss, fabs((double)b->energy.strain - (double)fbl_unit((double)a->energy.strain, 1, 2, -2)) /
                          ((double)fbl_unit((double)a->energy.kinetic + (double)a->energy.strain, 1, 2, -2) + 1e-300));
}

static fb_status motion_of(look *end, double step)
{
  fb_exact_state at = state;
  const fb_status status = steps(&at, STEPS, step);
  return status ? status : look_at(end, &at);
}

static double seen_as(const fbl_view *view)
{
  static look first, second;
  int map[FB_MAX_EXACT + 1], line[FB_MAX_EXACT + 1], place[FB_MAX_EXACT + 1];
  double miss;
  FBL_TRY(motion_of(&first, step_of(0.7)));
  for (int k = 0; k <= beam.n; k++) {
    line[k] = line_of_node(k, &place[k]);
  }
  fbl_seen = *view;
  FBL_TRY(fbl_draw_again());
  for (int k = 0; k <= beam.n; k++) {
    map[k] = line_begin(line[k]) + place[k];
  }
  FBL_TRY(motion_of(&second, step_of(0.7) * view->s));
  miss = looks_differ(&first, &second, beam.n, map);
  fbl_plain();
  return miss;
}

static double turned_and_shifted(double h)
{
  (void)h;
  return seen_as(&fbl_turned);
}

static double other_units(double h)
{
  (void)h;
  return seen_as(&fbl_other_units);
}

static double mirrored(double h)
{
  (void)h;
  return seen_as(&fbl_mirrored);
}

static double reordered(double h)
{
  (void)h;
  return now[BRANCH] == TWO_BRANCHES || input.n_load > 1 || desc.n_lump > 1 || now[JOINT] == TWO_JOINTS
             ? seen_as(&fbl_reordered)
             : FBL_NONE;
}

/* A free beam in flight at a speed moves as it does at rest. */
static double boosted(double h)
{
  static const fbl_view view = {1.0, 1.0, 1.0, 0, 0, 0, {1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {300.0, -200.0, 500.0}};
  static look first, second;
  double miss = 0.0;
  (void)h;
  if (now[BASE] != FREE) {
    return FBL_NONE;
  }
  FBL_TRY(motion_of(&first, step_of(0.7)));
  fbl_seen = view;
  FBL_TRY(fbl_draw_again());
  FBL_TRY(motion_of(&second, step_of(0.7)));
  fbl_plain();
  for (int k = 0; k <= beam.n; k++) {
    for (int i = 0; i < 3; i++) {
      miss = larger(miss, fabs((double)second.node[k].position[i] - (double)first.node[k].position[i] -
                               view.boost[i] * STEPS * step_of(0.7)) /
                              length_of());
    }
    miss = larger(miss, fbl_difference(first.node[k].angular_rate, second.node[k].angular_rate, 3) /
                            (fbl_largest(first.node[k].angular_rate, 3) + 1.0));
  }
  return miss;
}

/* ---- laws: the same beam otherwise */

/* The beam as it is and as draw_as has it: moves alike. Rotations without inertia ring at once and multiply rounding, by
   4e5 in these steps: single precision says nothing of them. */
static double built_as(int with_joint, int in_parts)
{
  static look first, second;
  int map[FB_MAX_EXACT + 1], n = beam.n;
  double miss;
  if (FB_SINGLE && now[ROTARY]) {
    return FBL_NONE;
  }
  FBL_TRY(motion_of(&first, step_of(0.7)));
  {
    const fb_status status = draw_as(1, with_joint, in_parts);
    if (status != FB_OK) {
      return fbl_refuse("built otherwise", status);
    }
  }
  for (int k = 0; k <= n; k++) {
    map[k] = k + (with_joint && k > 1);
  }
  FBL_TRY(motion_of(&second, step_of(0.7)));
  miss = looks_differ(&first, &second, n, map);
  fbl_plain();
  return miss;
}

static double locked_joint(double h)
{
  (void)h;
  return now[HELD] == HINGED || desc.n_joint >= JOINTS ? FBL_NONE : built_as(1, 0);
}

/* A support beyond the root is brought back to its place by a rule that weighs forces against moments in the beam's own
   units (E10.16), and these change with the length of the chain. */
static double two_halves(double h)
{
  (void)h;
  return now[HELD] == ROOT ? built_as(0, 1) : FBL_NONE;
}

/* ---- laws: steps */

/* What the work held before means nothing; a copy of the state, and a stepper, go on with the same bits. */
static double dirty_work(double h)
{
  static fb_exact_state a, b;
  static fb_stepper stepper;
  fb_stepper_desc how;
  (void)h;
  a = b = state;
  FBL_TRY(steps(&a, 3, step_of(0.7)));
  memset(&work, 0xff, sizeof work);
  memset(&how, 0, sizeof how);
  how.exact = &beam;
  how.exact_state = &b;
  how.exact_work = &work;
  how.exact_input = &input;
  how.dt = (fb_real)step_of(0.7);
  FBL_TRY(fb_stepper_init(&stepper, &how));
  for (int k = 0; k < 3; k++) {
    FBL_TRY(fb_stepper_step(&stepper));
    memset(&work, 0xff, sizeof work);
  }
  return memcmp(&a, &b, sizeof a) == 0 ? 0.0 : 1.0;
}

/* An input that is absent is one that is zero, to the last bit, in status, too. */
static double absent(double h)
{
  static const fb_exact_input zero;
  static fb_exact_state at[2], walked[2];
  fb_status status[2][3];
  (void)h;
  for (int k = 0; k < 2; k++) {
    const fb_exact_input *const in = k ? &zero : NULL;
    at[k] = state;
    status[k][0] = fb_exact_step(&beam, &at[k], &work, in, (fb_real)step_of(0.7));
    walked[k] = at[k];
    status[k][1] = fb_exact_state_init(&beam, &at[k], &work, in);
    status[k][2] = fb_exact_trim(&beam, &at[k], &work, in);
  }
  return memcmp(status[0], status[1], sizeof status[0]) == 0 && memcmp(&at[0], &at[1], sizeof at[0]) == 0 &&
                 memcmp(&walked[0], &walked[1], sizeof walked[0]) == 0
             ? 0.0
             : 1.0;
}

/* Loads over time: from nothing to nothing, smooth, so that nothing rings that the steps do not resolve. */
static fb_status pulse(fb_exact_state *at, int count, double duration)
{
  const fb_exact_input whole = input;
  fb_status status = fb_exact_state_init(&beam, at, &work, &input);
  for (int k = 0; k < count && status == FB_OK; k++) {
    const double push = pow(sin(3.14159265358979 * (k + 0.5) / count), 4.0);
    for (int i = 0; i < 3; i++) {
      for (int l = 0; l < whole.n_load; l++) {
        input.load[l].force[i] = (fb_real)(push * (double)whole.load[l].force[i]);
        input.load[l].torque[i] = (fb_real)(push * (double)whole.load[l].torque[i]);
      }
      for (int e = 0; e < beam.n; e++) {
        input.line[e].force[i] = (fb_real)(push * (double)whole.line[e].force[i]);
        input.line[e].torque[i] = (fb_real)(push * (double)whole.line[e].torque[i]);
      }
    }
    for (int i = 0; i < 3; i++) {
      input.support[0].displacement[i] = (fb_real)(push * (double)whole.support[0].displacement[i]);
    }
    for (int j = 0; j < beam.n_joint; j++) {
      input.motor[j] = (fb_real)(push * (double)whole.motor[j]);
    }
    status = fb_exact_step(&beam, at, &work, &input, (fb_real)(duration / count));
  }
  input = whole;
  return status;
}

/* Halved steps: the difference falls by four. */
static double order_of_steps(double h)
{
  static look run[3];
  double coarse = 0.0, off = 0.0;
  if (now[ROTARY] || now[HELD] != ROOT) { /* supports beyond the root are brought back in a way of their own (E10.16) */
    return FBL_NONE;
  }
  FBL_TRY(draw_simpler(CLAMPED, -1, 1, NULL)); /* else it begins with a jump */
  for (int j = 0; j < desc.n_joint; j++) {
    beam.joint[j].rate = FB_R(0.0);
  }
  for (int k = 0; k < 3; k++) {
    fb_exact_state at;
    FBL_TRY(pulse(&at, (int)(40.0 / h) << k, step_of(40.0)));
    FBL_TRY(look_at(&run[k], &at));
  }
  for (int k = 0; k <= beam.n; k++) {
    for (int i = 0; i < 3; i++) {
      const double x = (double)run[0].node[k].position[i], y = (double)run[1].node[k].position[i],
                   z = (double)run[2].node[k].position[i];
      coarse = larger(coarse, fabs(x - y));
      off = larger(off, fabs((x - y) - 4.0 * (y - z)));
    }
  }
  return off / (coarse + 1e-9 * length_of());
}

/* [m] Component of a node's displacement from where its support is. */
static double off_place(const fb_exact_node *at, int k, int i)
{
  const int moved = input.n_support > 0 && input.support[0].node == k;
  return (double)at->displacement[i] - (moved ? (double)input.support[0].displacement[i] : 0.0);
}

/* What is held stays in its place, and nothing else has a reaction. */
static double holds_of(double h)
{
  double miss = 0.0;
  FBL_TRY(walk(h, 10));
  for (int k = 0; k <= beam.n; k++) {
    const fb_exact_node *const b = &after.node[k];
    if (beam.held[k] == 0) {
      miss = larger(miss, fbl_largest(b->reaction_force, 3) + fbl_largest(b->reaction_moment, 3));
    }
    for (int i = 0; i < 3; i++) {
      const double off = beam.held[k] >> i & 1 ? fabs(off_place(b, k, i)) / length_of() : 0.0;
      miss = larger(miss, k == 0 && off > 0.0 ? 1.0 : off); /* the root exactly */
    }
  }
  return miss;
}

/* A single direction that is held is not brought back, along its reaction (E10.16); rotations without inertia jump in the
   first step after a release, however short, which leaves the square of the jump to the way back; else it is what elements
   turn. */
static double holds(double h)
{
  return now[HELD] == SLIDE || (now[ROTARY] && !now[START]) ? FBL_NONE : by_mesh(holds_of, h, 1e-4);
}

/* Near rest the equations are linear: what one iteration leaves of a step, and three of a steady state, falls with the
   square of what acts if the matrix is their derivative. */
static double small_steps(double h)
{
  static const int loads[] = {NO_LOAD, DEAD, FOLLOWER, OF_BASE, LINE};
  static look few, many;
  double size;
  amplitude = h;
  FBL_TRY(draw_simpler(-1, -1, 1, loads));
  for (int k = 0; k < 2; k++) {
    fb_exact_state at = state;
    fb_status status;
    beam.iterations = k ? 2 : 12;
    beam.factorizations = 1;
    status = steps(&at, 1, step_of(4.0));
    if (k && status != FB_OK) {
      return 1.0;
    }
    FBL_TRY(status);
    FBL_TRY(look_at(k ? &few : &many, &at));
  }
  size = h * length_of();
  {
    double miss = 0.0;
    for (int k = 0; k <= beam.n; k++) {
      miss = larger(miss, fbl_difference(few.node[k].position, many.node[k].position, 3) / size);
      miss = larger(miss, fbl_difference(few.node[k].moment, many.node[k].moment, 3) / (h * force_of() * length_of()));
      miss = larger(miss, fbl_difference(few.node[k].force, many.node[k].force, 3) / (h * force_of()) * 1e-2);
    }
    return miss;
  }
}

/* One wrong value in a legal scene is refused with the status of its kind, and changes nothing. */
static int wrong_descriptions(void)
{
  static fb_exact out;
  fb_exact_station *const root = &desc.station[0];
  const int elements = beam.n;
  int n = fb_exact_init(&out, &desc) != FB_OK;
#define MADE(what, wrong, status) FBL_WRONG(n, what, wrong, status, fb_exact_init(&out, &desc), out)
  MADE(desc.length, FB_R(0.0), FB_ERR_VALUE);
  MADE(desc.length, FBL_NAN, FB_ERR_NOT_FINITE);
  MADE(desc.n_element, 0, FB_ERR_CAPACITY);
  MADE(desc.n_element, FB_MAX_EXACT + 1, FB_ERR_CAPACITY);
  MADE(desc.n_station, 0, FB_ERR_CAPACITY);
  MADE(desc.n_station, FB_MAX_STATIONS + 1, FB_ERR_CAPACITY);
  MADE(desc.root, 128, FB_ERR_VALUE);
  MADE(desc.iterations, 21, FB_ERR_VALUE);
  MADE(desc.iterations, -1, FB_ERR_VALUE);
  MADE(desc.factorizations, 21, FB_ERR_VALUE);
  MADE(desc.dissipation, FB_R(0.7), FB_ERR_VALUE);
  MADE(desc.dissipation, FB_R(-0.1), FB_ERR_VALUE);
  MADE(desc.damping[4], FB_R(-1.0), FB_ERR_VALUE);
  MADE(desc.gravity[1], FBL_NAN, FB_ERR_NOT_FINITE);
  MADE(desc.position[2], FBL_NAN, FB_ERR_NOT_FINITE);
  MADE(desc.attitude[1], FBL_NAN, FB_ERR_NOT_FINITE);
  MADE(desc.place[1], FB_R(2.0) * desc.length, FB_ERR_VALUE);
  MADE(root->x, FB_R(0.1) * desc.length, FB_ERR_VALUE);
  MADE(root->stiffness[21], FB_R(-1.0), FB_ERR_VALUE);
  MADE(root->stiffness[28], FBL_NAN, FB_ERR_NOT_FINITE);
  MADE(root->stiffness[29], FB_R(10.0) * root->stiffness[28], FB_ERR_VALUE);
  MADE(root->inertia[7], -root->inertia[7], FB_ERR_VALUE);
  MADE(root->inertia[22], FB_R(1e3) * root->inertia[0] * desc.length * desc.length, FB_ERR_VALUE);
  MADE(root->twist, FBL_NAN, FB_ERR_NOT_FINITE);
  MADE(root->curvature[1], FBL_NAN, FB_ERR_NOT_FINITE);
  MADE(desc.n_support, FB_MAX_LUMPS + 1, FB_ERR_CAPACITY);
  MADE(desc.n_lump, FB_MAX_LUMPS + 1, FB_ERR_CAPACITY);
  MADE(desc.n_joint, FB_MAX_LUMPS + 1, FB_ERR_CAPACITY);
  MADE(desc.n_branch, FB_MAX_LUMPS + 1, FB_ERR_CAPACITY);
  if (desc.n_support > 0) {
    MADE(desc.support[0].node, elements + 1, FB_ERR_CAPACITY);
    MADE(desc.support[0].held, 128, FB_ERR_VALUE);
    MADE(desc.n_support, 0, FB_ERR_VALUE);
  }
  if (desc.n_lump > 0) {
    fb_lump *const lump = &desc.lump[desc.n_lump - 1];
    MADE(lump->node, elements + 1, FB_ERR_CAPACITY);
    MADE(lump->mass, FB_R(-1.0), FB_ERR_VALUE);
    MADE(lump->center[0], FBL_NAN, FB_ERR_NOT_FINITE);
    MADE(lump->inertia[1], lump->inertia[0] + lump->inertia[2] + lump->mass * desc.length * desc.length, FB_ERR_VALUE);
    MADE(desc.n_lump, 0, FB_ERR_VALUE);
  }
  if (desc.n_joint > 0) {
    fb_exact_joint *const joint = &desc.joint[desc.n_joint - 1];
    MADE(joint->element, elements, FB_ERR_CAPACITY);
    MADE(joint->element, -1, FB_ERR_CAPACITY);
    MADE(joint->axis[2], FBL_NAN, FB_ERR_NOT_FINITE);
    MADE(joint->stiffness, FB_R(-1.0), FB_ERR_VALUE);
    MADE(joint->damping, FB_R(-1.0), FB_ERR_VALUE);
    MADE(joint->rest, FBL_NAN, FB_ERR_NOT_FINITE);
    MADE(desc.n_joint, 0, FB_ERR_VALUE);
    if (desc.n_joint > 1) {
      MADE(joint->element, desc.joint[0].element, FB_ERR_VALUE);
    }
  }
  if (desc.n_branch > 0) {
    fb_exact_branch *const branch = &desc.branch[desc.n_branch - 1];
    MADE(branch->node, elements + 1, FB_ERR_CAPACITY);
    MADE(branch->n_element, 0, FB_ERR_CAPACITY);
    MADE(branch->n_element, FB_MAX_EXACT + 1, FB_ERR_CAPACITY);
    MADE(branch->length, FB_R(-1.0), FB_ERR_VALUE);
    MADE(branch->attitude[3], FBL_NAN, FB_ERR_NOT_FINITE);
  }
#undef MADE
  return n;
}

static int wrong_motions(void)
{
  static fb_exact_node node[FB_MAX_EXACT + 1];
  fb_exact_state at = state;
  fb_exact_element element;
  fb_exact_hinge hinge;
  fb_real step = (fb_real)(0.5 * drawn.fast), x = FB_R(0.0), place[3], quat[4];
  int n = fb_exact_nodes_eval(&beam, node, &at) != FB_OK, k = beam.n;
#define STATE(what, wrong, status)                                                             \
  do {                                                                                         \
    FBL_WRONG(n, what, wrong, status, fb_exact_state_check(&beam, &at), beam.n);               \
    FBL_WRONG(n, what, wrong, status, fb_exact_step(&beam, &at, &work, &input, step), beam.n); \
  } while (0)
  STATE(at.base_quat[0], FBL_NAN, FB_ERR_NOT_FINITE);
  STATE(at.base_position[1], FBL_NAN, FB_ERR_NOT_FINITE);
  STATE(at.r[3 * beam.n], FBL_NAN, FB_ERR_NOT_FINITE);
  STATE(at.quat[4 * beam.n + 1], FBL_NAN, FB_ERR_NOT_FINITE);
  STATE(at.strain[6 * beam.n - 1], FBL_NAN, FB_ERR_NOT_FINITE);
  STATE(at.momentum[0], FBL_NAN, FB_ERR_NOT_FINITE);
  STATE(at.u[2], FBL_NAN, FB_ERR_NOT_FINITE);
#undef STATE
#define INPUT(what, wrong, status) FBL_WRONG(n, what, wrong, status, fb_exact_step(&beam, &at, &work, &input, step), at)
  INPUT(step, FB_R(0.0), FB_ERR_VALUE);
  INPUT(step, FB_R(-0.01), FB_ERR_VALUE);
  INPUT(step, FBL_NAN, FB_ERR_NOT_FINITE);
  INPUT(input.n_load, FB_MAX_LOADS + 1, FB_ERR_CAPACITY);
  INPUT(input.n_load, -1, FB_ERR_CAPACITY);
  INPUT(input.line[0].axes, FB_AXES_COUNT, FB_ERR_VALUE);
  INPUT(input.line[beam.n - 1].force[1], FBL_NAN, FB_ERR_NOT_FINITE);
  if (input.n_load > 0) {
    fb_load *const load = &input.load[input.n_load - 1];
    INPUT(load->node, beam.n + 1, FB_ERR_CAPACITY);
    INPUT(load->node, -1, FB_ERR_CAPACITY);
    INPUT(load->axes, FB_AXES_COUNT, FB_ERR_VALUE);
    INPUT(load->torque[2], FBL_NAN, FB_ERR_NOT_FINITE);
  }
  if (now[BASE] != FREE) {
    INPUT(input.v[1], FBL_NAN, FB_ERR_NOT_FINITE);
    INPUT(input.w[0], FBL_NAN, FB_ERR_NOT_FINITE);
  }
  if (beam.n_joint > 0) {
    INPUT(input.motor[beam.n_joint - 1], FBL_NAN, FB_ERR_NOT_FINITE);
  }
#undef INPUT
  FBL_WRONG(n, k, beam.n, FB_ERR_CAPACITY, fb_exact_element_eval(&beam, &element, &at, k), element);
  FBL_WRONG(n, k, -1, FB_ERR_CAPACITY, fb_exact_element_eval(&beam, &element, &at, k), element);
  FBL_WRONG(n, k, beam.n_joint, FB_ERR_CAPACITY, fb_exact_joint_eval(&beam, &hinge, &at, k), hinge);
  FBL_WRONG(n, x, (fb_real)(-0.01 * length_of()), FB_ERR_VALUE, fb_exact_point_eval(&beam, place, quat, &at, x), place);
  FBL_WRONG(n, x, (fb_real)(20.0 * length_of()), FB_ERR_VALUE, fb_exact_point_eval(&beam, place, quat, &at, x), place);
  return n;
}

static double wrong(double h)
{
  (void)h;
  return wrong_descriptions() + wrong_motions();
}

/* What is no number in a model is refused by its check, or nothing reads it; a bit that the check word does not see is one
   that changes nothing. */
static double words(double h)
{
  static fb_exact other, own;
  static look first, second;
  const unsigned word = fb_exact_crc(&beam);
  static int map[FB_MAX_EXACT + 1];
  (void)h;
  if (fb_exact_check(&beam) != FB_OK || fb_exact_state_check(&beam, &state) != FB_OK) {
    return 1.0;
  }
  FBL_TRY(motion_of(&first, step_of(0.7)));
  for (int k = 0; k <= beam.n; k++) {
    map[k] = k;
  }
  fbl_stream("words");
  own = beam;
  for (int k = 0; k < 64; k++) {
    fb_status status;
    memcpy(&other, &own, sizeof other);
    (k < 24 ? fbl_spoil : fbl_flip)(&other, sizeof other);
    if (fb_exact_check(&other) != FB_OK || (k >= 24 && fb_exact_crc(&other) != word)) {
      continue;
    }
    beam = other;
    status = k % 8 ? FB_OK : motion_of(&second, step_of(0.7));
    beam = own;
    if (status || (k % 8 == 0 && looks_differ(&first, &second, own.n, map) > 0.0)) {
      return 1.0;
    }
  }
  return fb_exact_crc(&beam) == word ? 0.0 : 1.0;
}

/* ---- laws: steady states */

static int rests(void)
{
  return now[BASE] != FREE && now[JOINT] != LOOSE;
}

static void still(void) /* the input without what never comes to rest */
{
  for (int j = 0; j < FB_MAX_LUMPS; j++) {
    if (j < desc.n_joint && desc.joint[j].driven) {
      input.motor[j] = FB_R(0.0);
    }
  }
}

/* Curvature of the steady line a little before (side 0) and behind the place x [m], section axes. */
static fb_status bend_at(double bend[3], const fb_exact_state *at, double x, double d, int side)
{
  fb_real r[3], q[2][4], turn[4], w[3];
  fb_status status = fb_exact_point_eval(&beam, r, q[0], at, (fb_real)(side ? x + 1e-6 * d : x - d));
  status = status ? status : fb_exact_point_eval(&beam, r, q[1], at, (fb_real)(side ? x + d : x - 1e-6 * d));
  {
    const fb_real back[4] = {q[0][0], -q[0][1], -q[0][2], -q[0][3]};
    fb_quat_mul(turn, back, q[1]);
    fb_quat_to_rotvec(w, turn);
  }
  for (int i = 0; i < 3; i++) {
    bend[i] = (double)w[i] / d;
  }
  return status;
}

/* Points of the line between nodes begin and end where the nodes are, and bend alike on both sides of a node at which
   nothing acts. */
static double points_of(double h)
{
  double x = 0.0, miss = 0.0, most = 0.0;
  FBL_TRY(look_at(&before, &state));
  for (int k = 0; k < chain_size(); k++) {
    const double length = (double)beam.h[k] * (double)beam.length, d = h * length;
    fb_real r[3], q[4];
    {
      fb_real turn[3], c[3], back[4]; /* 4 tan(phi/4) within half a turn */
      fb_quat_from_rotvec(q, before.node[k + 1].rotation);
      fb_quat_to_wiener_milenkovic(c, q);
      fb_quat_from_wiener_milenkovic(back, c);
      fb_quat_to_rotvec(turn, q);
      for (int i = 0; i < 3; i++) {
        const double phi = sqrt(dot(turn, turn)), f = phi > 0.0 ? 4.0 * tan(0.25 * phi) / phi : 1.0;
        miss = larger(miss, fabs((double)before.node[k + 1].wiener_milenkovic[i] - f * (double)turn[i]));
        miss = larger(miss, fabs((double)c[i] - f * (double)turn[i]));
        miss = larger(miss, fabs(fabs((double)back[i]) - fabs((double)q[i])));
      }
    }
    if (beam.jointed[k]) {
      continue;
    }
    FBL_TRY(fb_exact_point_eval(&beam, r, q, &state, (fb_real)(x + 1e-9 * length)));
    miss = larger(miss, fbl_difference(r, before.node[beam.inboard[k]].position, 3) / length_of());
    x += length;
    FBL_TRY(fb_exact_point_eval(&beam, r, q, &state, (fb_real)(x * (1.0 - 1e-12))));
    miss = larger(miss, fbl_difference(r, before.node[k + 1].position, 3) / length_of());
    if (k + 1 < chain_size() && !beam.jointed[k + 1] && beam.held[k + 1] == 0 && k + 1 != extra_node()) {
      double left[3], right[3];
      FBL_TRY(bend_at(left, &state, x, d, 0));
      FBL_TRY(bend_at(right, &state, x, d, 1));
      for (int i = 0; i < 3; i++) {
        miss = larger(miss, fabs(left[i] - right[i]) * length);
        most = larger(most, fabs(left[i]) * length);
      }
    }
  }
  return miss / (most + 1e-3);
}

static double points(double h)
{
  static const int loads[] = {NO_LOAD, DEAD, FOLLOWER, OF_BASE, LINE};
  if (!rests() || now[BRANCH] == IN_LINE || now[BRANCH] == TWO_BRANCHES || now[RIGID] == 2) {
    return FBL_NONE;
  }
  now[CURVATURE] = 0;
  now[SECTION] = now[SECTION] == TWIST ? UNIFORM : now[SECTION];
  FBL_TRY(draw_simpler(CLAMPED, 0, 0, loads));
  return by_mesh(points_of, h, 1e-2);
}

/* A steady state holds its nodes to rounding. */
static double off_holds(const look *at)
{
  double most = 0.0;
  for (int i = 0; i < 6 * (beam.n + 1); i++) {
    const fb_exact_node *const node = &at->node[i / 6];
    const double off = i % 6 < 3 ? off_place(node, i / 6, i % 6) / length_of() : (double)node->rotation[i % 6 - 3];
    most = larger(most, beam.held[i / 6] >> i % 6 & 1 ? fabs(off) : 0.0);
  }
  return most;
}

static double trim_rests(double h)
{
  fb_exact_state at = state;
  if (!rests() || drifts() || (now[BASE] == MOVING && (now[GRAVITY] || now[LOAD] == DEAD || now[WAVES]))) {
    return FBL_NONE;
  }
  still();
  FBL_TRY(fb_exact_trim(&beam, &at, &work, &input));
  FBL_TRY(look_at(&before, &at));
  FBL_TRY(steps(&at, 20, step_of(h)));
  FBL_TRY(look_at(&after, &at));
  {
    double miss = off_holds(&before);
    for (int k = 0; k <= beam.n; k++) {
      miss = larger(miss, fbl_difference(before.node[k].displacement, after.node[k].displacement, 3) / length_of());
      miss = larger(miss, fbl_difference(before.node[k].angular_rate, after.node[k].angular_rate, 3));
      miss = larger(miss,
                    0.01 * fbl_difference(before.node[k].moment, after.node[k].moment, 3) / (force_of() * length_of()));
    }
    return miss;
  }
}

/* Force and moment about the inertial origin by the slope of the energy of gravity: of a shift, of a rotation. */
static double gravity_slope(const fb_exact_state *where, int i, int rotate)
{
  const double d = rotate ? 1e-3 : 1e-3 * length_of();
  fb_real U[5];
  for (int k = 0; k < 5; k++) {
    fb_exact_state at = *where;
    fb_energy energy;
    fb_real turn[3] = {0}, q[4];
    if (rotate) {
      turn[i] = (fb_real)(d * (k - 2));
      fb_quat_from_rotvec(q, turn);
      to_inertial(at.base_position, q, where->base_position);
      fb_quat_mul(at.base_quat, q, where->base_quat);
    } else {
      at.base_position[i] += (fb_real)(d * (k - 2));
    }
    if (fb_exact_energy_eval(&beam, &energy, &at) != FB_OK) {
      return HUGE_VAL;
    }
    U[k] = energy.gravity;
  }
  return -fbl_slope(U, 1, d);
}

/* Adds `part` of a force and a moment at a place to those about the inertial origin. */
static void wrench_add(double F[6], const fb_real *x, const fb_real *force, const fb_real *moment, double part)
{
  for (int i = 0; i < 3; i++) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    F[i] += part * (double)force[i];
    F[i + 3] += part * ((double)moment[i] + (double)x[j] * (double)force[k] - (double)x[k] * (double)force[j]);
  }
}

/* Place, to order 2 of its length, and axes of the middle of element k; turn, apart: the twist that leads from its inboard
   to its outboard node, of now and as built. */
static void element_pose(fb_real place[3], fb_real R[9], fb_real turn[2][3], fb_real apart[2][3], int k)
{
  for (int built = 1; built >= 0; built--) {
    const int in = beam.inboard[k], out = k + 1;
    const fb_real *const p = built ? beam.quat + 4 * in : before.node[in].quat;
    const fb_real *const q = built ? beam.quat + 4 * out : before.node[out].quat;
    const fb_real *const x = built ? beam.r + 3 * in : before.node[in].position;
    const fb_real *const y = built ? beam.r + 3 * out : before.node[out].position;
    const fb_real back[4] = {p[0], -p[1], -p[2], -p[3]};
    fb_real relative[4], middle[4], d[3];
    double size, share;
    fb_quat_mul(relative, back, q);
    fb_quat_to_rotvec(turn[built], relative);
    size = dot(turn[built], turn[built]);
    quat_between(middle, p, q);
    fb_quat_to_mat33(R, middle);
    for (int i = 0; i < 3; i++) {
      d[i] = (y[i] - x[i]) * (built ? beam.length : FB_R(1.0));
      place[i] = FB_R(0.5) * (x[i] + y[i]);
    }
    fb_mat33_mulT_vec3(apart[built], R, d); /* of an arc, whose chord is shorter */
    share = size > 0.0 ? dot(turn[built], apart[built]) / size : 0.0;
    for (int i = 0; i < 3; i++) {
      const double along = share * (double)turn[built][i];
      const double longer = size > 0.0 ? 0.5 * sqrt(size) / sin(0.5 * sqrt(size)) : 1.0;
      apart[built][i] = (fb_real)(along + longer * ((double)apart[built][i] - along));
    }
  }
}

/* Sum of loads, weight and reactions about the origin, over their size: of a steady state. */
static double unbalance(void)
{
  double F[6] = {0.0}, f_size = force_of(), m_size = force_of() * length_of(), miss = 0.0;
  for (int l = 0; l < input.n_load; l++) {
    const fb_load *const load = &input.load[l];
    const fb_real *const quat = load->axes == FB_AXES_NODE ? before.node[load->node].quat : before.state.base_quat;
    fb_real f[3], t[3];
    memcpy(f, load->force, sizeof f);
    memcpy(t, load->torque, sizeof t);
    if (load->axes != FB_AXES_INERTIAL) {
      to_inertial(f, quat, load->force);
      to_inertial(t, quat, load->torque);
    }
    wrench_add(F, before.node[load->node].position, f, t, 1.0);
  }
  for (int k = 0; k < beam.n && now[LOAD] == LINE; k++) {
    const fb_line_load *const load = &input.line[k];
    fb_real place[3], R[9], turn[2][3], apart[2][3], f[3], t[3];
    element_pose(place, R, turn, apart, k);
    if (load->axes == FB_AXES_NODE) {
      fb_mat33_mul_vec3(f, R, load->force);
      fb_mat33_mul_vec3(t, R, load->torque);
    } else {
      to_inertial(f, before.state.base_quat, load->force);
      to_inertial(t, before.state.base_quat, load->torque);
    }
    wrench_add(F, place, f, t, (double)(beam.h[k] * beam.length));
  }
  for (int k = 0; k <= beam.n; k++) {
    fb_real f[3], t[3];
    to_inertial(f, before.node[k].quat, before.node[k].reaction_force);
    to_inertial(t, before.node[k].quat, before.node[k].reaction_moment);
    wrench_add(F, before.node[k].position, f, t, 1.0);
    f_size += fbl_largest(f, 3);
    m_size += fbl_largest(f, 3) * length_of() + fbl_largest(t, 3);
  }
  for (int i = 0; i < 3; i++) {
    F[i] += now[GRAVITY] ? gravity_slope(&before.state, i, 0) : 0.0;
    F[i + 3] += now[GRAVITY] ? gravity_slope(&before.state, i, 1) : 0.0;
    miss = larger(miss, larger(fabs(F[i]) / f_size, fabs(F[i + 3]) / m_size));
  }
  return miss;
}

/* Miss of a law about the drawn state, or about the steady state under what acts, that meshes twice as fine divide by
   `least` or more. */
static double by_halves(double (*miss)(void), int steady, double least)
{
  double found[2];
  for (int k = 0; k < 2; k++) {
    const fb_status status = draw_as(1 + k, 0, 0);
    fb_exact_state at;
    if (status != FB_OK) {
      return fbl_refuse("finer", status);
    }
    still();
    at = state;
    FBL_TRY(steady ? fb_exact_trim(&beam, &at, &work, &input) : FB_OK);
    FBL_TRY(look_at(&before, &at));
    found[k] = miss();
  }
  return found[1] < found[0] / least ? 0.0 : found[1];
}

/* What holds a steady beam balances what acts, to the order 4 of what an element loses by its turn;
   the weight and loads along the line to order 2. */
static double reactions_balance(double h)
{
  (void)h;
  if (!rests()) {
    return FBL_NONE;
  }
  now[BASE] = CLAMPED;
  return by_halves(unbalance, 1, now[GRAVITY] || now[LOAD] == LINE ? 3.0 : 8.0);
}

/* ---- laws: outputs by element, each from those of its two nodes. Halved lengths divide a miss of order 2 by four, by a
   little less where elements turn far. */

/* Mean of vectors in the axes of the two nodes, in those of the middle. */
static void element_mean(fb_real mean[3], const fb_real R[9], int k, const fb_real *a, const fb_real *b)
{
  fb_real x[3], y[3];
  to_inertial(x, before.node[beam.inboard[k]].quat, a);
  to_inertial(y, before.node[k + 1].quat, b);
  for (int i = 0; i < 3; i++) {
    x[i] = FB_R(0.5) * (x[i] + y[i]);
  }
  fb_mat33_mulT_vec3(mean, R, x);
}

/* Does what is at its inboard side reach element k whole: no load, body, branch, hold at that node? */
static int is_plain(int k)
{
  const int in = beam.inboard[k];
  int plain = in == 0 || beam.held[in] == 0;
  for (int l = 0; l < input.n_load; l++) {
    plain &= input.load[l].node != in;
  }
  for (int l = 0; l < desc.n_lump; l++) {
    plain &= desc.lump[l].node != in || !now[GRAVITY];
  }
  for (int other = 0; other < beam.n; other++) {
    plain &= other == k || beam.inboard[other] != in;
  }
  return plain || in == 0;
}

/* Of a steady state: forces and moments are the means of those at the nodes, to order 2 of the length; strains are what
   sets the nodes apart. */
static double strains_of_nodes(void)
{
  double sum = 0.0;
  for (int k = 0; k < beam.n; k++) {
    const double length = (double)beam.h[k] * (double)beam.length;
    const fb_exact_element *const own = &before.element[k];
    fb_real R[9], turn[2][3], apart[2][3], mean[3], place[3];
    const fb_exact_node *const a = &before.node[beam.inboard[k]], *const b = &before.node[k + 1];
    double miss = 0.0;
    if (beam.jointed[k]) {
      continue;
    }
    element_pose(place, R, turn, apart, k);
    element_mean(mean, R, k, a->force, b->force);
    miss = larger(miss, is_plain(k) ? fbl_difference(mean, own->force, 3) / force_of() : 0.0);
    element_mean(mean, R, k, a->moment, b->moment);
    miss = larger(miss, is_plain(k) ? fbl_difference(mean, own->moment, 3) / (force_of() * length_of()) : 0.0);
    for (int i = 0; i < 3; i++) {
      turn[0][i] = (turn[0][i] - turn[1][i]) / (fb_real)length;
      apart[0][i] = (apart[0][i] - apart[1][i]) / (fb_real)length;
    }
    miss = larger(miss, fbl_difference(turn[0], own->moment_strain, 3) * length_of());
    miss = larger(miss, fbl_difference(apart[0], own->force_strain, 3) / 1e-2);
    sum += length / length_of() * miss;
  }
  return sum;
}

static double strains(double h)
{
  (void)h;
  if (!rests()) {
    return FBL_NONE;
  }
  now[BASE] = CLAMPED;
  return by_halves(strains_of_nodes, 1, 2.5);
}

/* In rigid motion: velocities are the means of those of the nodes, momenta those of the whole but for lumped bodies. */
static double momenta_of_elements(void)
{
  double miss = 0.0, off[6] = {0.0};
  for (int i = 0; i < 3; i++) {
    off[i] = -(double)before.momentum.linear[i];
    off[3 + i] = -(double)before.momentum.angular[i];
  }
  for (int k = 0; k < beam.n; k++) {
    const fb_exact_element *const own = &before.element[k];
    const fb_exact_node *const a = &before.node[beam.inboard[k]], *const b = &before.node[k + 1];
    fb_real R[9], turn[2][3], apart[2][3], mean[3], p[3], t[3], place[3];
    if (beam.jointed[k]) {
      continue;
    }
    element_pose(place, R, turn, apart, k);
    element_mean(mean, R, k, a->velocity, b->velocity);
    miss = larger(miss, now[ROTARY] ? 0.0 : over(mean, own->velocity, speed_of()));
    element_mean(mean, R, k, a->angular_rate, b->angular_rate);
    miss = larger(miss, now[ROTARY] ? 0.0 : over(mean, own->angular_rate, 1.0));
    fb_mat33_mul_vec3(p, R, own->momentum);
    fb_mat33_mul_vec3(t, R, own->angular_momentum);
    wrench_add(off, place, p, t, (double)beam.h[k] * (double)beam.length);
  }
  for (int l = 0; l < desc.n_lump; l++) {
    const fb_lump *const lump = &desc.lump[l];
    const fb_exact_node *const node = &before.node[lump->node];
    const fb_real *const J = lump->inertia, *const w = node->angular_rate;
    fb_real v[3], p[3], t[3], spin[3];
    fb_vec3_cross(v, w, lump->center);
    for (int i = 0; i < 3; i++) {
      v[i] = lump->mass * (v[i] + node->velocity[i]);
    }
    fb_vec3_cross(t, lump->center, v);
    t[0] += J[0] * w[0] + J[3] * w[1] + J[4] * w[2];
    t[1] += J[3] * w[0] + J[1] * w[1] + J[5] * w[2];
    t[2] += J[4] * w[0] + J[5] * w[1] + J[2] * w[2];
    to_inertial(p, node->quat, v);
    to_inertial(spin, node->quat, t);
    wrench_add(off, node->position, p, spin, 1.0);
  }
  for (int i = 0; i < 6; i++) {
    const double mass = drawn.mass * drawn.length[0];
    miss = larger(miss, fabs(off[i]) / (mass * drawn.length[0] * (i < 3 ? 1.0 : drawn.length[0])));
  }
  return miss;
}

static double momenta(double h)
{
  (void)h;
  now[START] = 1;
  legal(now);
  return by_halves(momenta_of_elements, 0, 2.5);
}

/* Steady states on a path under growing loads are those of the trim under the loads of its factor. */
static double path_and_trim(double h)
{
  static fb_exact_path_work path_work;
  static fb_exact_path path;
  fb_exact_state at = state, same;
  fb_exact_input constant = input, varied;
  const double unit = drawn.EI / (drawn.length[0] * drawn.length[0]);
  double miss = 0.0;
  (void)h;
  if (!rests()) {
    return FBL_NONE;
  }
  still();
  constant = input;
  FBL_TRY(fb_exact_trim(&beam, &at, &work, &input));
  memset(&varied, 0, sizeof varied);
  memset(&path, 0, sizeof path);
  varied.n_load = 1;
  varied.load[0].node = node_at(0, drawn.n[0]);
  varied.load[0].axes = FB_AXES_NODE;
  fbl_polar(varied.load[0].force, 0.2 * unit, 0.8 * unit, -0.5 * unit, 1, 1, -2);
  for (int k = 0; k < 3; k++) {
    FBL_TRY(fb_exact_path_step(&beam, &path, &at, &path_work, &constant, &varied, FB_R(0.05)));
  }
  input.load[input.n_load] = varied.load[0];
  for (int i = 0; i < 3; i++) {
    input.load[input.n_load].force[i] *= path.factor;
  }
  input.n_load++;
  same = at;
  FBL_TRY(fb_exact_trim(&beam, &same, &work, &input));
  FBL_TRY(look_at(&before, &at));
  FBL_TRY(look_at(&after, &same));
  for (int k = 0; k <= beam.n; k++) {
    miss = larger(miss, fbl_difference(before.node[k].displacement, after.node[k].displacement, 3) / length_of());
    miss = larger(miss,
                  0.01 * fbl_difference(before.node[k].moment, after.node[k].moment, 3) / (force_of() * length_of()));
  }
  return path.unstable == work.unstable ? miss : 1.0;
}

static fb_exact_linear linear;
static fb_exact_linear_work linear_work;
static fb_exact_spectrum spectrum;

/* Steady output of the linear model for a constant input: D - C A^-1 B; A of blocks [re -im; im re]. */
static double static_gain(int out)
{
  double sum = (double)linear.D[out];
  for (int k = 0, at = 0; k < linear.n_mode; k++) {
    const double re = (double)linear.re[k], im = (double)linear.im[k], size = re * re + im * im;
    const int pair = linear.im[k] > FB_R(0.0);
    const double a = (double)linear.B[at], b = pair ? (double)linear.B[at + 1] : 0.0;
    sum -= (double)linear.C[out * linear.n + at] * (re * a + im * b) / size;
    sum -= pair ? (double)linear.C[out * linear.n + at + 1] * (re * b - im * a) / size : 0.0;
    at += 1 + pair;
  }
  return sum;
}

/* The static response of the linear model is the slope of the steady states, whatever the modes that it keeps; its
   eigenvalues are those of the spectrum. A base that spins: loads that turn along. */
static double slope_of(double h)
{
  static fb_linear_desc ports;
  fb_exact_state at = state, moved;
  fb_real y[5][3];
  const double unit = drawn.EI / (drawn.length[0] * drawn.length[0]), f = 0.004 * (double)fbl_unit(unit, 1, 1, -2);
  double miss = 0.0, most = 0.01 * length_of() / force_of();
  (void)h;
  still();
  FBL_TRY(fb_exact_trim(&beam, &at, &work, &input));
  memset(&ports, 0, sizeof ports);
  ports.n_in = 1;
  ports.in[0].kind = FB_PORT_FORCE;
  ports.in[0].node = node_at(0, drawn.n[0] - 1); /* the tip may be held */
  ports.in[0].axis = 1;
  ports.in[0].axes = FB_AXES_BODY;
  ports.n_out = 3;
  for (int i = 0; i < 3; i++) {
    ports.out[i].kind = FB_PORT_DISPLACEMENT;
    ports.out[i].node = extra_node();
    ports.out[i].axis = i;
  }
  FBL_TRY(fb_exact_linearize(&beam, &linear_work, &linear, &at, &input, &ports, 4));
  FBL_TRY(fb_exact_spectrum_solve(&beam, &linear_work.spectrum, &spectrum, &at, &input, linear.n_mode));
  for (int k = 0; k < linear.n_mode; k++) {
    const double off =
        fabs((double)linear.re[k] - (double)spectrum.re[k]) + fabs((double)linear.im[k] - (double)spectrum.im[k]);
    miss = larger(miss, off / (fabs((double)spectrum.re[k]) + fabs((double)spectrum.im[k])));
  }
  for (int k = 0; k < 5; k++) {
    fb_exact_input pushed = input;
    pushed.load[pushed.n_load].node = ports.in[0].node;
    pushed.load[pushed.n_load].axes = FB_AXES_BODY;
    pushed.load[pushed.n_load++].force[1] = (fb_real)(f * (k - 2));
    moved = at;
    FBL_TRY(fb_exact_trim(&beam, &moved, &work, &pushed));
    FBL_TRY(look_at(&after, &moved));
    memcpy(y[k], after.node[extra_node()].displacement, sizeof y[k]);
  }
  for (int i = 0; i < 3; i++) {
    most = larger(most, fabs(fbl_slope(&y[0][i], 3, f)));
  }
  for (int i = 0; i < 3; i++) {
    miss = larger(miss, fabs(fbl_slope(&y[0][i], 3, f) - static_gain(i)) / most);
  }
  return miss;
}

/* But for what an element turns: the model is that of the step, which closes in velocities. */
static double linear_slope(double h)
{
  if (!rests() || now[ELEMENTS] > 1 || now[RIGID] == 2) { /* small ones: a spectrum takes time */
    return FBL_NONE;
  }
  return by_mesh(slope_of, h, 1e-6);
}

/* ---- single follows double */

static fb_status digest(void)
{
  static look end;
  const fb_status status = motion_of(&end, step_of(1.5));
  for (int k = 0; k <= beam.n && status == FB_OK; k += 3) {
    for (int i = 0; i < 3; i++) {
      fbl_say((double)end.node[k].position[i], drawn.length[0]);
    }
  }
  if (status == FB_OK) {
    fbl_say((double)end.energy.kinetic + (double)end.energy.strain, drawn.EI / drawn.length[0]);
    fbl_say((double)end.energy.gravity, drawn.EI / drawn.length[0]);
  }
  return status;
}

/* ---- the list */

static const fbl_law laws[] = {
    {"velocities_are_derivatives", "E11.20 E11.21", velocities, 0.04, {1e-5, 0}},
    {"joints_turn_by_their_rates", "E10.21 E10.22", joint_rates, 0.04, {1e-6, 0}},
    {"energy_of_long_steps", "E10.7 E10.8 E11.20 E11.56", energy_of_long_steps, 0.0, {1e-8, 1e-3}},
    {"energy_changes_by_power", "E10.13 E11.20", energy_changes_by_power, 0.04, {1e-4, 0}},
    {"flight_keeps_momentum", "E10.14 E11.21", flight_keeps_momentum, 1.5, {3e-5, 1e-3}},
    {"dissipation_takes_energy", "E11.20", dissipation_takes, 0.0, {1e-12, 1e-4}},
    {"turned_and_shifted", "E10.8", turned_and_shifted, 0.0, {1e-9, 3e-2}},
    {"other_units", "E10.4", other_units, 0.0, {1e-9, 3e-2}},
    {"mirror_image", "E10.7 E10.8", mirrored, 0.0, {1e-9, 3e-2}},
    {"order_of_loads_and_branches", "E10.26", reordered, 0.0, {1e-9, 3e-2}},
    {"flight_at_any_speed", "E11.33", boosted, 0.0, {1e-8, 1e-2}},
    {"a_locked_joint_is_none", "E10.22 E10.23", locked_joint, 0.0, {1e-8, 1e-2}},
    {"two_halves_are_one", "E10.26 E10.27", two_halves, 0.0, {1e-8, 1e-2}},
    {"dirty_work_and_stepper", "E11.20", dirty_work, 0.0, {0.5, 0.5}},
    {"what_is_absent_is_zero", "E10.11 E11.20", absent, 0.0, {0.5, 0.5}},
    {"steps_are_of_order_two", "E11.20", order_of_steps, 2.0, {0.2, 0}},
    {"points_follow_the_line", "E10.12", points, 0.02, {1e-2, 0}},
    {"long_steps_of_small_motions", "E11.20 E10.18", small_steps, 1e-4, {1e-6, 0}},
    {"models_and_their_check_words", "E10.4", words, 0.0, {0.5, 0}},
    {"what_is_wrong_is_refused", "E10.4 E11.20", wrong, 0.0, {0.5, 0.5}},
    {"what_is_held_stays", "E10.16 E10.17", holds, 0.4, {1e-4, 1e-2}},
    {"trim_rests", "E10.11 E11.20", trim_rests, 0.2, {1e-6, 0}},
    {"paths_lead_through_trims", "E12.17", path_and_trim, 0.0, {1e-7, 1e-2}},
    {"linear_models_are_slopes", "E12.14 E12.15", linear_slope, 0.0, {1e-6, 0}},
    {"reactions_balance", "E10.11 E10.13", reactions_balance, 0.0, {1e-6, 0}},
    {"elements_bear_what_their_nodes_do", "E10.7 E10.11", strains, 0.0, {1e-6, 0}},
    {"elements_have_the_momentum_of_all", "E10.6 E10.14", momenta, 0.0, {1e-9, 0}},
};

const fbl_kind fbl_exact = {"exact", features, FBL_COUNT(features), legal, draw, laws, FBL_COUNT(laws), digest};
