/* draw.c - random legal bodies: every feature that they have, in every combination that the library takes. */
#include "laws.h"

static fb_beam beam[2];
static fb_modes modes[2];
static fb_modes_work modes_work;
static fb_join_work join_work;
static fb_body_work body_work;
static fb_shape shape;
static fb_beam_desc beam_desc;
static fb_modes_desc modes_desc;
static fb_body_desc desc;
int fbl_missing;

void fbl_legal(fbl_choice *c)
{
  if (c->effects == FBL_STRAIN) { /* axial functions of one straight beam */
    c->basis = FBL_FUNCTIONS;
    c->modes = FBL_AXIAL;
    c->parts = FBL_ONE_BEAM;
    c->section = c->section == FBL_OFFSET ? FBL_UNIFORM : c->section;
  }
  if (c->effects == FBL_LARGE) { /* lines: natural modes or components, no chain of kinks under a component */
    c->basis = c->basis >= FBL_ELEMENTS && c->basis != FBL_ATTACHED ? FBL_NATURAL : c->basis;
  }
  if (c->basis == FBL_FUNCTIONS) { /* no shear, torsion, joints; clamped */
    c->shear = 0;
    c->modes = c->modes == FBL_TORSION ? FBL_BOTH : c->modes;
    c->parts = c->parts >= FBL_WELDED ? FBL_ONE_BEAM : c->parts;
  }
  if (c->basis == FBL_ELEMENTS || c->basis == FBL_SPUN) {
    c->parts = c->parts >= FBL_WELDED ? FBL_ONE_BEAM : c->parts;
  }
  if (c->basis == FBL_ELEMENTS) {
    c->parts = FBL_ONE_BEAM;
  }
  if (c->gravity == FBL_CENTER && (c->effects == FBL_LINEAR || c->effects == FBL_SPIN || c->effects == FBL_STRAIN)) {
    c->gravity = FBL_GRAVITY;
  }
  if (c->parts == FBL_CURVED) { /* kinks want every stiffness, and inertia about every axis */
    c->modes = FBL_AXIAL;
    c->section = c->section == FBL_TWIST ? FBL_UNIFORM : c->section;
  }
}

fbl_points fbl_told;

double fbl_points_miss(const fbl_points *told, size_t stride, double h, double size)
{
  const fbl_points *const now = (const fbl_points *)((const fb_real *)told + 2 * stride);
  double miss = 0.0;
  for (int b = 0; b < FB_MAX_BODIES; b++) {
    miss = now->told[b] == now->own[b] ? miss : 1.0;
    for (int k = 0; k < 3 && now->told[b]; k++) {
      fb_real turning[3];
      double v_off = 0.0, w_off = 0.0;
      fb_vec3_cross(turning, now->angular_rate[b][k], now->along[b][k]);
      for (int i = 0; i < 3; i++) {
        v_off = larger(v_off, fabs(fbl_slope(&told->position[b][k][i], stride, h) - (double)now->velocity[b][k][i]));
        w_off = larger(w_off, fabs(fbl_slope(&told->along[b][k][i], stride, h) - (double)turning[i]));
      }
      miss = larger(miss, v_off / (fbl_largest(now->velocity[b][k], 3) + 0.1 * (double)fbl_unit(size, 0, 1, -1)));
      miss = larger(miss, w_off / (fbl_largest(now->angular_rate[b][k], 3) + 0.1 * (double)fbl_unit(1.0, 0, 0, -1)));
    }
  }
  return miss;
}

static void points_tell(const fb_line_point *point, int n)
{
  const int b = point[0].body;
  for (int k = 0; k < 3; k++) {
    const fb_line_point *const p = &point[k * (n - 1) / 2];
    for (int i = 0; i < 3; i++) {
      fbl_told.position[b][k][i] = p->position[i];
      fbl_told.velocity[b][k][i] = p->velocity[i];
      fbl_told.along[b][k][i] = p->R[3 * i];
      fbl_told.angular_rate[b][k][i] = p->angular_rate[i];
    }
  }
  fbl_told.told[b] = n;
  fbl_told.own[b] = 0;
  for (int k = 0; k < n; k++) {
    fbl_told.own[b] += point[k].body == b;
  }
}

fb_status fbl_wind(fb_line_point *point, int n, fb_real t, void *user)
{
  const double size = *(const double *)user;
  fb_real along[3];
  (void)t;
  points_tell(point, n);
  fbl_inertial_polar(along, 0.1, -0.15, 0.2, 1, 0, -2);
  for (int k = 0; k < n; k++) {
    const double share = (double)point[k].length * (1.0 + (double)point[k].x / (double)fbl_unit(size, 0, 1, 0));
    for (int i = 0; i < 3; i++) {
      point[k].force[i] = (fb_real)(share * (double)along[i]);
    }
  }
  return FB_OK;
}

/* ---- beams */

static void section_draw(fb_section *s, double x, double length, double factor, const fbl_choice *c)
{
  static double mass, EI_y, EI_z, thin, offset[4];
  if (x <= 0.0) { /* one draw a beam */
    const double first = fbl_in(3.0, 15.0), way = first * length * length / 3.516;
    mass = fbl_in(0.5, 4.0);
    EI_z = way * way * mass;
    EI_y = EI_z * fbl_in(0.6, 2.0);
    thin = fbl_in(0.008, 0.02) * length;
    for (int k = 0; k < 4; k++) {
      offset[k] = fbl_in(-0.01, 0.01) * length;
    }
  }
  memset(s, 0, sizeof *s);
  s->x = fbl_unit(x, 0, 1, 0);
  s->mass = fbl_unit(mass * factor, 1, -1, 0);
  s->EI_y = fbl_unit(EI_y * factor * factor, 1, 3, -2);
  s->EI_z = fbl_unit(EI_z * factor * factor, 1, 3, -2);
  if (c->modes >= FBL_TORSION || c->section == FBL_OFFSET) {
    s->GJ = fbl_unit(0.6 * EI_z * factor, 1, 3, -2);
    s->i_y = fbl_unit(mass * factor * thin * thin, 1, 1, 0);
    s->i_z = fbl_unit(1.3 * mass * factor * thin * thin, 1, 1, 0);
  }
  if (c->modes == FBL_AXIAL || c->section == FBL_OFFSET) {
    s->EA = fbl_unit(EI_z * factor / (thin * thin), 1, 1, -2);
  }
  if (c->shear) {
    s->GA_y = fbl_unit(0.2 * EI_z * factor / (thin * thin), 1, 1, -2);
    s->GA_z = fbl_unit(0.3 * EI_z * factor / (thin * thin), 1, 1, -2);
  }
  if (c->section == FBL_TWIST) {
    s->twist = fbl_unit((fbl_seen.mirror ? -1.0 : 1.0) * 0.6 * x / length, 0, 0, 0);
  }
  if (c->section == FBL_OFFSET) {
    const double sign = fbl_seen.mirror ? -1.0 : 1.0;
    s->mass_y = fbl_unit(sign * offset[0], 0, 1, 0);
    s->mass_z = fbl_unit(offset[1], 0, 1, 0);
    s->tension_y = fbl_unit(sign * offset[2], 0, 1, 0);
    if (c->shear) {
      s->shear_z = fbl_unit(offset[3], 0, 1, 0);
    }
  }
}

static void lump_draw(int node, double mass, double reach, int tensor)
{
  fb_lump *const lump = &beam_desc.lump[beam_desc.n_lump++];
  double center[3] = {0.0, 0.0, 0.0}, tilt[3], moment[3];
  lump->node = node;
  lump->mass = fbl_unit(mass, 1, 0, 0);
  for (int i = 0; i < 3; i++) {
    center[i] = fbl_in(-reach, reach);
    tilt[i] = fbl_in(-0.3, 0.3);
    moment[i] = mass * reach * reach * fbl_in(0.5, 0.9);
  }
  if (tensor) {
    const double flip = fbl_seen.mirror ? -1.0 : 1.0, small = 0.3 * mass * reach * reach;
    fbl_polar(lump->center, center[0], center[1], center[2], 0, 1, 0);
    for (int i = 0; i < 3; i++) {
      lump->inertia[i] = fbl_unit(moment[i], 1, 2, 0);
      lump->inertia[3 + i] = fbl_unit((i == 1 ? 1.0 : flip) * small * tilt[i], 1, 2, 0);
    }
  }
}

/* The root of a beam on the hub, or where another one ends. */
static void place(double x, double y, double z, double length, double angle)
{
  const double half = 0.5 * angle, tilt = 0.1;
  const double q[4] = {cos(half) * cos(tilt), cos(half) * sin(tilt), sin(half) * sin(tilt), sin(half) * cos(tilt)};
  fbl_polar(beam_desc.position, x, y, z, 0, 1, 0);
  fbl_quat(beam_desc.attitude, q, 0);
  beam_desc.length = fbl_unit(length, 0, 1, 0);
}

static void beam_draw(double length, const fbl_choice *c, int first)
{
  const int n = c->section == FBL_UNIFORM || c->section == FBL_OFFSET ? 1 : 4;
  beam_desc.n_station = n;
  for (int k = 0; k < n; k++) {
    const double x = n > 1 ? length * k / (n - 1) : 0.0;
    section_draw(&beam_desc.station[k], x, length, c->section == FBL_TAPER ? 1.0 - 0.5 * x / length : 1.0, c);
    if (c->parts == FBL_CURVED || (first && c->parts == FBL_WELDED)) {
      beam_desc.station[k].EA =
          fbl_unit((double)beam_desc.station[k].EI_z / (double)fbl_unit(1.0, 1, 3, -2) * 2e3, 1, 1, -2);
    }
  }
  if (c->lumps != FBL_NO_LUMP) {
    lump_draw(beam_desc.n_element, fbl_in(0.3, 2.0), 0.03 * length, c->lumps >= FBL_TENSOR);
  }
  if (c->lumps == FBL_SEVERAL) {
    lump_draw(beam_desc.n_element / 2, fbl_in(0.3, 2.0), 0.02 * length, 1);
  }
  if (first && c->parts == FBL_WELDED && c->lumps == FBL_NO_LUMP) {
    lump_draw(beam_desc.n_element, 1e-3, 0.0, 0); /* where the other one is attached a point is wanted */
  }
  if (c->parts == FBL_CURVED) {
    const double bow = fbl_in(0.02, 0.06);
    double x = 0.0, y = 0.0, end = 0.0;
    beam_desc.n_point = beam_desc.n_element + 1;
    for (int k = 1; k < beam_desc.n_point; k++) {
      const double dx = length / beam_desc.n_element, dy = dx * bow * 2.0 * k;
      x += dx;
      y += dy;
      end += sqrt(dx * dx + dy * dy);
      fbl_polar(beam_desc.point[k], x, y, 0.0, 0, 1, 0);
    }
    beam_desc.length = fbl_unit(end, 0, 1, 0);
  }
  if (n > 1) {
    beam_desc.station[n - 1].x = beam_desc.length;
  }
}

static void modes_draw(const fbl_choice *c, int loose)
{
  const int many = 1 + fbl_pick(2), n = c->import || c->parts || c->modes >= FBL_TORSION ? 1 : many;
  memset(&modes_desc, 0, sizeof modes_desc);
  modes_desc.count[FB_KIND_BEND_Y] = n + 1;
  modes_desc.count[FB_KIND_BEND_Z] = c->modes == FBL_ONE_PLANE ? 0 : n;
  modes_desc.count[FB_KIND_TORSION] = c->modes == FBL_TORSION && c->basis != FBL_FUNCTIONS;
  modes_desc.count[FB_KIND_AXIAL] = c->modes == FBL_AXIAL && c->parts != FBL_CURVED;
  modes_desc.rigid = loose;
  modes_desc.line_points = 8;
  if (c->parts == FBL_CURVED || (c->section == FBL_OFFSET && c->modes != FBL_ONE_PLANE)) { /* kinds couple */
    memset(modes_desc.count, 0, sizeof modes_desc.count);
    modes_desc.lowest = 3;
  }
  switch (loose && c->basis == FBL_COMPONENT ? FBL_NATURAL : c->basis) {
  case FBL_ATTACHED: /* further modes, for loads at the tip */
    modes_desc.n_load = c->modes == FBL_ONE_PLANE || c->parts ? 1 : 2;
    modes_desc.load[0].node = modes_desc.load[1].node = beam_desc.n_element;
    modes_desc.load[0].axis = 1;
    modes_desc.load[1].axis = 2;
    break;
  case FBL_COMPONENT:
    modes_desc.basis = FB_BASIS_COMPONENT;
    modes_desc.n_boundary = 2;
    modes_desc.boundary[0].node = modes_desc.boundary[1].node = beam_desc.n_element;
    modes_desc.boundary[0].axis = 1;
    modes_desc.boundary[1].axis = c->modes == FBL_ONE_PLANE ? 5 : 2;
    break;
  case FBL_ELEMENTS:
    modes_desc.basis = FB_BASIS_ELEMENTS;
    break;
  case FBL_FUNCTIONS:
    modes_desc.basis = FB_BASIS_FUNCTIONS;
    modes_desc.count[0] = modes_desc.count[1] = n;
    if (c->effects == FBL_STRAIN) { /* of one element as many axial functions, and its strain at the root */
      modes_desc.count[0] = modes_desc.count[1] = modes_desc.count[2] = 2;
      modes_desc.root_strain = 1;
    }
    break;
  case FBL_SPUN:
    modes_desc.spin = fbl_unit(fbl_in(1.0, 4.0), 0, 0, -1);
    modes_desc.count[0] = 2;
    modes_desc.lowest = 0;
    break;
  default:
    break;
  }
}

/* The number of modes that the description names. */
static int asked_for(void)
{
  int n = 0;
  for (int k = 0; k < FB_KIND_COUNT; k++) {
    n += modes_desc.count[k];
  }
  if (modes_desc.basis == FB_BASIS_FUNCTIONS) {
    return n + modes_desc.root_strain;
  }
  n = modes_desc.lowest > 0 ? modes_desc.lowest : n;
  return n + modes_desc.n_load + modes_desc.n_boundary;
}

/* Modes of one beam, or of all that are on the hub or joined; the number of coordinates. */
static fb_status beams_draw(const fbl_choice *c, int *n, int *n_beam, double *size)
{
  static const fb_join_desc weld = {.n_weld = 1, .lowest = 4, .weld = {{.component = {0, 1}, .node = {4, 0}}}};
  const double length = fbl_in(2.0, 8.0), start = fbl_in(0.1, 0.3);
  fb_status status = FB_OK;
  *n_beam = c->parts == FBL_TWO_BEAMS || c->parts == FBL_WELDED ? 2 : 1;
  *size = length * (c->parts == FBL_WELDED ? 1.5 : 1.0);
  *n = 0;
  for (int k = 0; k < *n_beam && status == FB_OK; k++) {
    const int loose = k == 1 && c->parts == FBL_WELDED, at = fbl_seen.reverse && c->parts == FBL_TWO_BEAMS ? 1 - k : k;
    const double own = k == 0 ? length : fbl_in(0.3, 0.6) * length;
    memset(&beam_desc, 0, sizeof beam_desc);
    beam_desc.n_element = c->basis == FBL_ELEMENTS || c->effects == FBL_STRAIN ? 1 : 4;
    if (loose) {
      fb_real tip[3];
      memcpy(tip, &beam[0].node[3 * 4], sizeof tip);
      beam_desc.root = FB_ROOT_FREE;
      place(0.0, 0.0, 0.0, own, 1.0);
      fb_mat33_mul_vec3(beam_desc.position, beam[0].axes, tip);
      for (int i = 0; i < 3; i++) {
        beam_desc.position[i] += beam[0].desc.position[i];
      }
    } else {
      place(start * (k == 0 ? 1.0 : -1.0), 0.1, -0.05, own, k == 0 ? 0.2 : 2.8);
    }
    beam_draw(own, c, k == 0);
    status = fb_beam_init(&beam[at], &beam_desc);
    modes_draw(c, loose);
    status = status ? status : fb_modes_solve(&modes[at], &modes_work, &beam[at], &modes_desc);
    if (modes_desc.basis != FB_BASIS_ELEMENTS && !modes_desc.rigid) {
      fbl_missing += asked_for() - modes[at].n;
    }
    *n += status == FB_OK ? modes[at].n : 0;
  }
  if (status == FB_OK && c->parts == FBL_WELDED) {
    status = fb_modes_join(modes, &join_work, beam, modes, &weld, 2);
    *n = modes[0].n;
  }
  return status;
}

/* ---- shapes */

static void hub_draw(const fbl_choice *c, double size)
{
  const double mass = c->hub == 1 ? fbl_in(0.3, 1.0) : fbl_in(5.0, 40.0), reach = size * fbl_in(0.1, 0.2);
  double center[3] = {0.0, 0.0, 0.0};
  fb_real at[3], inertia[6];
  for (int i = 0; i < 3; i++) {
    center[i] = c->hub == 2 ? fbl_in(-0.2, 0.2) : 0.0;
    inertia[i] = fbl_unit(mass * reach * reach * fbl_in(0.6, 1.0), 1, 2, 0);
    inertia[3 + i] =
        fbl_unit((fbl_seen.mirror && i != 1 ? -1.0 : 1.0) * (c->hub == 2) * 0.1 * mass * reach * reach, 1, 2, 0);
  }
  fbl_polar(at, center[0], center[1], center[2], 0, 1, 0);
  (void)fb_shape_add_rigid(&shape, fbl_unit(mass, 1, 0, 0), at, inertia);
}

/* K of the imported coordinates, of frequencies that are drawn. */
static void stiffness_draw(int first, int count)
{
  for (int a = first; a < first + count; a++) {
    const double omega = fbl_in(4.0, 20.0), own = (double)fbl_unit(omega * omega, 0, 0, -2);
    shape.K[a * shape.n + a] = (fb_real)(own * (double)shape.M[a * shape.n + a]);
  }
}

/* Second degree of coordinates a, b of a component: integrals of a displacement field, geometric stiffness. */
static fb_status pair_draw(int a, int b)
{
  const double flip = fbl_seen.mirror ? -1.0 : 1.0;
  fb_real pchi[3], hchi[3], Gamchi[9], accelerate[3], turn[3], spin[6];
  fb_status status;
  fbl_polar(pchi, fbl_in(-0.5, 0.5), fbl_in(-0.5, 0.5), fbl_in(-0.5, 0.5), 1, -1, 0);
  fbl_axial(hchi, fbl_in(-0.5, 0.5), fbl_in(-0.5, 0.5), fbl_in(-0.5, 0.5), 1, 0, 0);
  for (int i = 0; i < 9; i++) {
    Gamchi[i] = fbl_unit(((i / 3 == 1) != (i % 3 == 1) ? flip : 1.0) * fbl_in(-0.5, 0.5), 1, 0, 0);
  }
  status = fb_shape_add_pair(&shape, a, b, pchi, hchi, Gamchi);
  fbl_polar(accelerate, fbl_in(-0.5, 0.5), fbl_in(-0.5, 0.5), fbl_in(-0.5, 0.5), 1, -1, 0);
  fbl_axial(turn, fbl_in(-0.5, 0.5), fbl_in(-0.5, 0.5), fbl_in(-0.5, 0.5), 1, 0, 0);
  for (int i = 0; i < 6; i++) {
    spin[i] = fbl_unit((i == 3 || i == 5 ? flip : 1.0) * fbl_in(-0.5, 0.5), 1, 0, 0);
  }
  return status ? status : fb_shape_add_stiffening(&shape, a, b, accelerate, turn, spin);
}

/* Shapes of coordinates first.. at a node: displacements, rotations, and displacements of second degree. */
static void shapes_draw(fb_real *psi, fb_real *theta, fb_real *chi, int first, int count)
{
  const int n = shape.n;
  memset(psi, 0, (size_t)(3 * n) * sizeof *psi);
  memset(theta, 0, (size_t)(3 * n) * sizeof *theta);
  memset(chi, 0, (size_t)(3 * n * n) * sizeof *chi);
  for (int a = first; a < first + count; a++) {
    fbl_polar(&psi[3 * a], fbl_in(-1.0, 1.0), fbl_in(-1.0, 1.0), fbl_in(-1.0, 1.0), 0, 0, 0);
    fbl_axial(&theta[3 * a], fbl_in(-1.0, 1.0), fbl_in(-1.0, 1.0), fbl_in(-1.0, 1.0), 0, -1, 0);
    for (int b = first; b <= a; b++) {
      fb_real *const x = &chi[3 * (a * n + b)];
      fbl_polar(x, fbl_in(-1.0, 1.0), fbl_in(-1.0, 1.0), fbl_in(-1.0, 1.0), 0, -1, 0);
      memcpy(&chi[3 * (b * n + a)], x, 3 * sizeof *x);
    }
  }
}

/* Coordinates first.. of a component that is no beam: three masses with random shapes, those of FBL_FIELDS on a line that
   keeps its length. */
static fb_status import_draw(int first, int count, int import)
{
  static fb_real psi[3 * FB_MAX_MODES], theta[3 * FB_MAX_MODES], chi[3 * FB_MAX_MODES * FB_MAX_MODES];
  static fb_fields fields[3];
  fb_status status = FB_OK;
  for (int k = 0; k < 3 && status == FB_OK; k++) {
    const double mass = fbl_in(0.5, 3.0);
    const fb_real m = fbl_unit(mass, 1, 0, 0);
    fb_real r[3], inertia[6] = {0};
    int node;
    fbl_polar(r, 0.8 * k - 1.0, fbl_in(-0.5, 0.5), fbl_in(-0.5, 0.5), 0, 1, 0);
    shapes_draw(psi, theta, chi, first, count);
    for (int i = 0; i < 3; i++) {
      inertia[i] = fbl_unit(0.01 * mass * fbl_in(0.6, 1.0), 1, 2, 0);
    }
    if (import == FBL_PARTICLES) {
      status = fb_shape_add_particle(&shape, m, r, psi, chi);
      continue;
    }
    if (import == FBL_FIELDS) {
      status = fb_fields_init(&fields[k], &shape, k ? &fields[k - 1] : NULL, r, psi, theta);
      status = status ? status : fb_shape_add_field_lump(&shape, &fields[k], m, inertia);
      status = status || k ? status : fb_shape_add_field_node(&shape, &node, &fields[k]);
      continue;
    }
    status = fb_shape_add_lump(&shape, m, r, inertia, psi, theta);
    status = status || k ? status : fb_shape_add_node(&shape, &node, r, psi, theta);
  }
  for (int a = first; a < first + count && status == FB_OK && import == FBL_STIFFENED; a++) {
    for (int b = first; b <= a && status == FB_OK; b++) {
      status = pair_draw(a, b);
    }
  }
  stiffness_draw(first, count);
  return status;
}

int fbl_node(const fbl_choice *c, int k)
{
  return fbl_seen.reverse && c->parts == FBL_TWO_BEAMS && k > 0 && k <= 2 ? 3 - k : k;
}

static void rotors_draw(const fbl_choice *c, int n_node)
{
  desc.n_rotor = c->rotors == FBL_NO_ROTOR ? 0 : c->rotors == FBL_ON_HUB ? 2 : 3;
  desc.n_rotor = c->rotors == FBL_GIVEN && fbl_pick(2) ? 1 : desc.n_rotor;
  for (int r = 0; r < desc.n_rotor; r++) {
    fb_rotor *const rotor = &desc.rotor[r];
    rotor->node = fbl_node(c, r > 0 && c->rotors >= FBL_ON_BOOM && n_node > 1);
    rotor->node = r == 2 && c->effects != FBL_STRAIN ? n_node : rotor->node; /* the last node, which is still to come */
    rotor->inertia = fbl_unit(fbl_in(0.01, 0.05), 1, 2, 0);
    fbl_axial(rotor->axis, fbl_in(0.2, 1.0), fbl_in(-1.0, 1.0), fbl_in(-1.0, 1.0), 0, 0, 0);
    if (c->rotors == FBL_RUBBING) {
      rotor->damping = fbl_unit(1e-3, 1, 2, -1);
      rotor->friction = fbl_unit(5e-3, 1, 2, -2);
      rotor->friction_speed = fbl_unit(3.0, 0, 0, -1);
    }
    if (c->rotors == FBL_UNBALANCED && r > 0) {
      rotor->static_imbalance = fbl_unit(1e-3, 1, 1, 0);
      rotor->dynamic_imbalance = fbl_unit(5e-4, 1, 2, 0);
      rotor->dynamic_phase = FB_R(0.7);
    }
    rotor->given = c->rotors == FBL_GIVEN && r != 1;
  }
}

static void desc_draw(const fbl_choice *c, int n_node, double size)
{
  static const unsigned set[] = {FB_EFFECTS_FULL,   FB_EFFECTS_RIGID,
                                 FB_EFFECTS_LINEAR, FB_EFFECTS_SPIN,
                                 FB_EFFECTS_LARGE,  3u | FB_EFFECT_RESIDUAL_INERTIA | FB_EFFECT_NONLINEAR_STRAIN};
  memset(&desc, 0, sizeof desc);
  desc.base = (fb_base)c->base;
  desc.effects = set[c->effects];
  desc.deflection_limit = fbl_unit(5.0 * size, 0, 1, 0);
  if (c->damping && c->effects != FBL_RIGID) {
    desc.effects |= FB_EFFECT_DAMPING;
    for (int a = 0; a < shape.n; a++) { /* two beams may change places, and their modes */
      desc.zeta[a] = a > 0 && c->parts == FBL_TWO_BEAMS ? desc.zeta[0] : (fb_real)fbl_in(0.002, 0.05);
    }
  }
  fbl_stream("gravity");
  if (c->gravity == FBL_GRAVITY) {
    desc.effects |= FB_EFFECT_GRAVITY;
    fbl_inertial_polar(desc.gravity, fbl_in(-3.0, 3.0), fbl_in(-3.0, 3.0), fbl_in(-3.0, 3.0), 0, 1, -2);
  }
  if (c->gravity == FBL_CENTER) {
    const double d = size * fbl_in(30.0, 60.0);
    fb_real shift[3];
    desc.mu = fbl_unit(0.04 * d * d * d, 0, 3, -2);
    fbl_inertial_polar(desc.center, 0.6 * d, -0.64 * d, 0.48 * d, 0, 1, 0);
    for (int i = 0; i < 3; i++) {
      shift[i] = fbl_unit(fbl_seen.shift[i], 0, 1, 0);
      desc.center[i] += shift[i];
    }
  }
  fbl_stream("rotors");
  rotors_draw(c, n_node);
}

static fb_status make(fb_body *body, const fbl_choice *c, double *size)
{
  int n = 0, n_beam = 0, extra = c->import == FBL_NO_IMPORT ? 0 : 2;
  fb_status status;
  fbl_missing = 0;
  fbl_stream("beams");
  status = beams_draw(c, &n, &n_beam, size);
  status = status ? status : fb_shape_init(&shape, n + extra);
  if (status != FB_OK) {
    return status;
  }
  fbl_stream("hub");
  hub_draw(c, *size);
  for (int k = 0, first = 0; k < n_beam && status == FB_OK; k++) {
    const int joined = c->parts == FBL_WELDED;
    int node;
    status = fb_shape_add_beam(&shape, first, &beam[k], &modes[k]);
    status = status ? status
                    : fb_shape_add_beam_node(&shape, &node, first, &beam[k], &modes[k],
                                             beam[k].start[beam[k].desc.n_element]);
    if (status == FB_OK && c->effects == FBL_STRAIN) {
      status = fb_shape_add_beam_strain(&shape, first, &beam[k], &modes[k]);
    }
    first += joined ? 0 : modes[k].n;
  }
  fbl_stream("import");
  status = status == FB_OK && extra ? import_draw(n, extra, (int)c->import) : status;
  fbl_stream("effects");
  desc_draw(c, shape.n_node, *size);
  fbl_stream("way");
  if (status == FB_OK && c->effects != FBL_STRAIN) { /* the last node: on the last beam, near its root or not */
    const int last = n_beam - 1, at = fbl_seen.reverse && c->parts == FBL_TWO_BEAMS ? 0 : last;
    int node, first = at > 0 && c->parts == FBL_TWO_BEAMS ? modes[0].n : 0;
    status = fb_shape_add_beam_node(&shape, &node, first, &beam[at], &modes[at],
                                    (fbl_pick(2) ? FB_R(0.1) : FB_R(0.6)) * beam[at].start[beam[at].desc.n_element]);
  }
  return status ? status : fb_body_init(body, &body_work, &shape, &desc);
}

/* What was made before: most of the time would go there. */
typedef struct memory {
  struct {
    fbl_choice choice;
    fbl_view view;
    double signature;
  } key;
  fb_body body;
  double size;
  int missing;
} memory;

fb_status fbl_make(fb_body *body, const fbl_choice *c, double *size)
{
  static memory kept[8], now;
  static int oldest;
  fb_status status;
  memset(&now.key, 0, sizeof now.key);
  now.key.choice = *c;
  now.key.view = fbl_seen;
  now.key.view.undeformed = 0;
  memset(now.key.view.boost, 0, sizeof now.key.view.boost);
  fbl_stream("signature");
  now.key.signature = fbl_in(1.0, 2.0);
  for (int k = 0; k < FBL_COUNT(kept); k++) {
    if (memcmp(&kept[k].key, &now.key, sizeof now.key) == 0) {
      *body = kept[k].body;
      *size = kept[k].size;
      fbl_missing = kept[k].missing;
      return FB_OK;
    }
  }
  status = make(&now.body, c, &now.size);
  *body = now.body;
  *size = now.size;
  if (status == FB_OK) {
    now.missing = fbl_missing;
    kept[oldest] = now;
    oldest = (oldest + 1) % FBL_COUNT(kept);
  }
  return status;
}

void fbl_deflect(fb_real *q, fb_real *q_dot, const fb_body *body, double size)
{
  const double energy = 0.01 * (double)body->mass * (double)fbl_unit(size * size, 0, 2, -2);
  fbl_stream("deflection");
  for (int a = 0; a < body->n; a++) {
    const double mass = body->unit_mass ? 1.0 : (double)body->M.diagonal[a], stiffness = (double)body->K.diagonal[a];
    q[a] = (fb_real)(sqrt(energy / stiffness) * fbl_in(-1.0, 1.0));
    q_dot[a] = (fb_real)(sqrt(energy / mass) * fbl_in(-1.0, 1.0));
    if (fbl_seen.undeformed) {
      q[a] = q_dot[a] = FB_R(0.0);
    }
  }
}

/* ---- what is wrong */

static int wrong_beams(void)
{
  static fb_beam out;
  static fb_modes out_modes;
  const int last = beam_desc.n_station - 1;
  fb_section *const root = &beam_desc.station[0];
  int n = fb_beam_init(&out, &beam_desc) != FB_OK;
#define BEAM(at, wrong, status) FBL_WRONG(n, at, wrong, status, fb_beam_init(&out, &beam_desc), out)
  BEAM(beam_desc.n_element, 0, FB_ERR_CAPACITY);
  BEAM(beam_desc.n_element, FB_MAX_ELEMENTS + 1, FB_ERR_CAPACITY);
  BEAM(beam_desc.root, FB_ROOT_COUNT, FB_ERR_VALUE);
  BEAM(beam_desc.n_station, 0, FB_ERR_CAPACITY);
  BEAM(beam_desc.n_station, FB_MAX_STATIONS + 1, FB_ERR_CAPACITY);
  BEAM(beam_desc.n_lump, FB_MAX_LUMPS + 1, FB_ERR_CAPACITY);
  BEAM(beam_desc.position[2], FBL_NAN, FB_ERR_NOT_FINITE);
  BEAM(beam_desc.attitude[0], FBL_NAN, FB_ERR_NOT_FINITE);
  BEAM(root->mass, -root->mass, FB_ERR_VALUE);
  BEAM(root->EI_y, -root->EI_z, FB_ERR_VALUE);
  BEAM(root->EI_z, FBL_NAN, FB_ERR_NOT_FINITE);
  BEAM(root->EA, FB_R(-1.0), FB_ERR_VALUE);
  BEAM(root->GJ, FB_R(-1.0), FB_ERR_VALUE);
  BEAM(root->i_y, FB_R(-1.0), FB_ERR_VALUE);
  if (last > 0) {
    BEAM(beam_desc.station[last].x, FB_R(0.9) * beam_desc.length, FB_ERR_VALUE);
    BEAM(beam_desc.station[last].x, FB_R(0.0), FB_ERR_VALUE);
    BEAM(root->x, FB_R(0.1) * beam_desc.length, FB_ERR_VALUE);
  }
  if (beam_desc.n_lump > 0) {
    fb_lump *const lump = &beam_desc.lump[0];
    BEAM(lump->node, beam_desc.n_element + 1, FB_ERR_CAPACITY);
    BEAM(lump->node, -1, FB_ERR_CAPACITY);
    BEAM(lump->mass, -lump->mass, FB_ERR_VALUE);
    BEAM(lump->center[1], FBL_NAN, FB_ERR_NOT_FINITE);
    BEAM(lump->inertia[2], lump->inertia[0] + lump->inertia[1] + lump->mass * beam_desc.length * beam_desc.length,
         FB_ERR_VALUE);
    BEAM(beam_desc.n_lump, 0, FB_ERR_VALUE);
  }
  if (beam_desc.n_point > 0) {
    BEAM(beam_desc.n_point, beam_desc.n_point - 1, FB_ERR_VALUE);
    BEAM(beam_desc.point[1][0], FBL_NAN, FB_ERR_NOT_FINITE);
    BEAM(beam_desc.point[2][0], FB_R(0.0), FB_ERR_VALUE); /* turns back */
  } else {
    BEAM(beam_desc.length, FB_R(0.0), FB_ERR_VALUE);
    BEAM(beam_desc.length, FBL_NAN, FB_ERR_NOT_FINITE);
  }
#undef BEAM
#define MODES(at, wrong, status) \
  FBL_WRONG(n, at, wrong, status, fb_modes_solve(&out_modes, &modes_work, &beam[0], &modes_desc), out_modes)
  MODES(modes_desc.basis, FB_BASIS_COUNT, FB_ERR_VALUE);
  MODES(modes_desc.count[0], -1, FB_ERR_VALUE);
  MODES(modes_desc.omega_limit, FB_R(-1.0), FB_ERR_VALUE);
  MODES(modes_desc.mass_fraction, FB_R(1.5), FB_ERR_VALUE);
  MODES(modes_desc.n_load, FB_MAX_COORDINATES + 1, FB_ERR_CAPACITY);
  MODES(modes_desc.n_boundary, FB_MAX_COORDINATES + 1, FB_ERR_CAPACITY);
  MODES(modes_desc.preload.force, FBL_NAN, FB_ERR_NOT_FINITE);
  if (modes_desc.n_load > 0) {
    MODES(modes_desc.load[0].node, beam[0].desc.n_element + 1, FB_ERR_CAPACITY);
    MODES(modes_desc.load[0].axis, 6, FB_ERR_CAPACITY);
  }
  if (modes_desc.n_boundary > 0) {
    MODES(modes_desc.boundary[1].node, beam[0].desc.n_element + 1, FB_ERR_CAPACITY);
    MODES(modes_desc.boundary[1].axis, -1, FB_ERR_CAPACITY);
  }
#undef MODES
  return n;
}

static int wrong_shapes(void)
{
  static fb_shape out;
  fb_real mass = FB_R(2.0), at[3] = {FB_R(0.1), FB_R(0.2), FB_R(0.3)};
  fb_real inertia[6] = {FB_R(1.0), FB_R(1.5), FB_R(2.0), FB_R(0.1), FB_R(0.0), FB_R(-0.1)};
  int n = 0, node = 0;
  out = shape;
  n += fb_shape_add_rigid(&out, mass, at, inertia) != FB_OK;
#define RIGID(what, wrong, status) FBL_WRONG(n, what, wrong, status, fb_shape_add_rigid(&out, mass, at, inertia), out)
  RIGID(mass, FB_R(-2.0), FB_ERR_VALUE);
  RIGID(mass, FBL_NAN, FB_ERR_NOT_FINITE);
  RIGID(at[0], FB_R(2.0) * FB_HUGE, FB_ERR_NOT_FINITE);
  RIGID(inertia[0], FB_R(-1.0), FB_ERR_VALUE);
  RIGID(inertia[1], FB_R(0.5), FB_ERR_VALUE); /* a triangle of 1, 0.5, 2 */
  RIGID(inertia[2], FB_R(2.6), FB_ERR_VALUE);
  RIGID(inertia[3], FB_R(1.6), FB_ERR_VALUE);
  RIGID(inertia[5], FBL_NAN, FB_ERR_NOT_FINITE);
#undef RIGID
#define PARTICLE(what, wrong, status) \
  FBL_WRONG(n, what, wrong, status, fb_shape_add_particle(&out, mass, at, shape.P, NULL), out)
  PARTICLE(mass, FB_R(-1.0), FB_ERR_VALUE);
  PARTICLE(at[1], FBL_NAN, FB_ERR_NOT_FINITE);
#undef PARTICLE
  FBL_WRONG(n, at[2], FBL_NAN, FB_ERR_NOT_FINITE, fb_shape_add_node(&out, &node, at, shape.P, shape.P), out);
  FBL_WRONG(n, out.n_node, FB_MAX_NODES, FB_ERR_CAPACITY, fb_shape_add_node(&out, &node, at, shape.P, shape.P), node);
  return n;
}

int fbl_wrong_bodies(const fbl_choice *c)
{
  static fb_body out;
  double size;
  int n = make(&out, c, &size) != FB_OK;
  n += wrong_beams() + wrong_shapes();
#define BODY(at, wrong, status) FBL_WRONG(n, at, wrong, status, fb_body_init(&out, &body_work, &shape, &desc), out)
  BODY(desc.base, FB_BASE_COUNT, FB_ERR_VALUE);
  BODY(desc.effects, desc.effects | 0x40000000u, FB_ERR_EFFECTS);
  BODY(desc.deflection_limit, FB_R(-1.0), FB_ERR_VALUE);
  BODY(desc.mu, FB_R(-1.0), FB_ERR_VALUE);
  BODY(desc.center[0], FBL_NAN, FB_ERR_NOT_FINITE);
  BODY(desc.gravity[1], FBL_NAN, FB_ERR_NOT_FINITE);
  BODY(desc.truncation, FB_TRUNCATE_COUNT, FB_ERR_VALUE);
  if (!(desc.effects & FB_EFFECT_GRAVITY)) {
    BODY(desc.gravity[0], FB_R(1.0), FB_ERR_EFFECTS);
  }
  if (shape.n > 0 && (desc.effects & FB_EFFECT_DAMPING)) {
    BODY(desc.zeta[0], FB_R(-0.01), FB_ERR_VALUE);
    BODY(desc.zeta[shape.n - 1], FBL_NAN, FB_ERR_NOT_FINITE);
  } else if (shape.n > 0) {
    BODY(desc.zeta[shape.n - 1], FB_R(0.01), FB_ERR_EFFECTS);
  }
  if (out.n > 0) { /* of a rigid body nobody reads it */
    BODY(shape.M[0], FB_R(-1.0), FB_ERR_SINGULAR);
  }
  BODY(desc.n_rotor, FB_MAX_ROTORS + 1, FB_ERR_CAPACITY);
  BODY(desc.n_rotor, -1, FB_ERR_CAPACITY);
  if (desc.n_rotor > 0) {
    fb_rotor *const rotor = &desc.rotor[desc.n_rotor - 1];
    BODY(rotor->node, shape.n_node, FB_ERR_CAPACITY);
    BODY(rotor->node, -1, FB_ERR_CAPACITY);
    BODY(rotor->inertia, FB_R(0.0), FB_ERR_VALUE);
    BODY(rotor->axis[2], FBL_NAN, FB_ERR_NOT_FINITE);
    BODY(rotor->damping, FB_R(-1.0), FB_ERR_VALUE);
    BODY(rotor->friction, FB_R(-1.0), FB_ERR_VALUE);
    BODY(rotor->static_imbalance, FB_R(-1.0), FB_ERR_VALUE);
    BODY(rotor->dynamic_phase, FBL_NAN, FB_ERR_NOT_FINITE);
    BODY(desc.n_rotor, 0, FB_ERR_VALUE);
    if (!(rotor->friction_speed > FB_R(0.0))) {
      BODY(rotor->friction, FB_R(1.0), FB_ERR_VALUE);
    }
  }
#undef BODY
  return n;
}
