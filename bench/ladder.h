/* ladder.h - a scene by the exact beam and by modal bodies of every set of effects, number of modes, integrator and
   step, geometrically exact ones among them: error and time of each. */
#ifndef FBB_LADDER_H
#define FBB_LADDER_H

#include "case.h"

#define FBB_MAX_ENTRIES 12000

/* Rungs of the ladder: what a picture shows as one curve. */
enum {
  FBB_RIGID = 0,
  FBB_LINEAR = 1,
  FBB_SOME = 2,
  FBB_FULL = 3,
  FBB_STRAIN = 4,
  FBB_LARGE = 5,
  FBB_EXACT = 6,
  FBB_RUNGS = 7
};
static const char *const fbb_rung_name[] = {"rigid", "linear", "some", "full", "strain", "large", "exact"};

typedef struct fbb_entry {
  const char *level, *integrator;
  int rung, effects; /* of the exact beam: no mask */
  fbb_basis basis;
  double dt, error, ns_per_s;
} fbb_entry;

typedef struct fbb_level {
  const char *name;
  int rung;
  unsigned effects;
} fbb_level;

/* C spin coupling, R residual inertia, S spin stiffening, A acceleration stiffening. */
static const fbb_level fbb_levels[] = {
    {"rigid", FBB_RIGID, FB_EFFECTS_RIGID},
    {"linear", FBB_LINEAR, FB_EFFECTS_LINEAR},
    {"C", FBB_SOME, FB_EFFECTS_SPIN},
    {"S", FBB_SOME, FB_EFFECTS_LINEAR | FB_EFFECT_SPIN_STIFFENING},
    {"A", FBB_SOME, FB_EFFECTS_LINEAR | FB_EFFECT_ACCELERATION_STIFFENING},
    {"CS", FBB_SOME, FB_EFFECTS_SPIN | FB_EFFECT_SPIN_STIFFENING},
    {"CA", FBB_SOME, FB_EFFECTS_SPIN | FB_EFFECT_ACCELERATION_STIFFENING},
    {"SA", FBB_SOME, FB_EFFECTS_LINEAR | FB_EFFECT_SPIN_STIFFENING | FB_EFFECT_ACCELERATION_STIFFENING},
    {"CSA", FBB_SOME, FB_EFFECTS_SPIN | FB_EFFECT_SPIN_STIFFENING | FB_EFFECT_ACCELERATION_STIFFENING},
    {"CRS", FBB_SOME, FB_EFFECTS_SPIN | FB_EFFECT_RESIDUAL_INERTIA | FB_EFFECT_SPIN_STIFFENING},
    {"full", FBB_FULL, FB_EFFECTS_FULL},
};

static fbb_entry fbb_entries[FBB_MAX_ENTRIES];
static int fbb_n_entry;
static fbb_history fbb_reference;
static int fbb_quick; /* every other step, and no fewer than 3 points more than modes */

static void fbb_record(const fbb_entry *e, const fbb_history *h)
{
  if (fbb_n_entry == FBB_MAX_ENTRIES) {
    fprintf(stderr, "more than %d runs of a scene\n", FBB_MAX_ENTRIES);
    exit(1);
  }
  fbb_entries[fbb_n_entry] = *e;
  fbb_entries[fbb_n_entry].error = h->status == FB_OK ? fbb_difference(h, &fbb_reference) : HUGE_VAL;
  fbb_entries[fbb_n_entry].ns_per_s = h->ns_per_s;
  fbb_n_entry++;
}

/* ---- reference */

static void fbb_extrapolate(fbb_history *out, const fbb_history *coarse, const fbb_history *fine)
{
  *out = *fine;
  for (int k = 0; k < FBB_SAMPLES; k++) {
    fbb_extrapolate_row(out->out[k], coarse->out[k], fine->out[k]);
  }
}

/* Sets the reference and records the three solutions it is made of; returns how far it is estimated to be off. */
static double fbb_reference_make(const fbb_case *c)
{
  static fbb_history run[3], rough;
  const int elements = c->elements ? c->elements : 16, steps = c->steps ? c->steps : 8;
  fbb_entry e = {"exact", "exact", FBB_EXACT, 0, {0, 0, 0, 0, 0, 0}, 0, 0, 0};
  for (int k = 0; k < 3; k++) {
    fbb_exact_run(&run[k], c, elements << k, steps << k);
    fbb_check(run[k].status, c->name);
  }
  fbb_extrapolate(&rough, &run[0], &run[1]);
  fbb_extrapolate(&fbb_reference, &run[1], &run[2]);
  for (int k = 0; k < 3; k++) {
    e.basis.elements = elements << k;
    e.dt = c->duration / FBB_SAMPLES / (steps << k);
    fbb_record(&e, &run[k]);
  }
  return fbb_difference(&rough, &fbb_reference) / 4;
}

static void fbb_climb_exact(const fbb_case *c)
{
  static fbb_history h;
  fbb_entry e = {"exact", "exact", FBB_EXACT, 0, {0, 0, 0, 0, 0, 0}, 0, 0, 0};
  for (int n = 4; n <= 64; n *= 2) {
    for (int steps = 1; steps <= 8; steps *= 2) {
      fbb_exact_run(&h, c, n, steps);
      e.basis.elements = n;
      e.dt = c->duration / FBB_SAMPLES / steps;
      fbb_record(&e, &h);
    }
  }
}

/* ---- modal bodies */

/* Whether loads act on the tip along y, z (fbb_basis.load): by the drive where it is strongest. */
static int fbb_tip_loads(const fbb_case *c)
{
  fbb_drive drive;
  fbb_drive_at(&drive, c, 0.5 * c->period);
  return c->at == FBB_TIP ? (drive.force[1] != 0.0) + 2 * (drive.force[2] != 0.0) : 0;
}

/* The spin [rad/s] about z that modes may be made for; 0: none. */
static double fbb_modes_spin(const fbb_case *c)
{
  return c->steady ? c->spin[2] : c->drive == fbb_drive_spinup ? c->size : 0.0;
}

/* Its time is the least of three where that of one is too short to be trusted. */
static void fbb_body_run_timed(fbb_history *h, const fbb_case *c, const fb_body *body, fb_integrator integrator,
                               int steps)
{
  double least;
  fbb_body_run(h, c, body, integrator, steps);
  least = h->ns_per_s;
  for (int k = 0; k < 2 && h->status == FB_OK && least * c->duration < 3e6; k++) {
    fbb_body_run(h, c, body, integrator, steps);
    least = fmin(least, h->ns_per_s);
  }
  h->ns_per_s = least;
}

static void fbb_climb_steps(const fbb_case *c, const fb_body *body, fbb_entry *e)
{
  static fbb_history h;
  const double sample = c->duration / FBB_SAMPLES, limit = (double)fb_rk4_limit(body, (fb_real)fbb_largest_spin(c), 0);
  const int fewest = limit < sample ? (int)ceil(sample / limit) : 1;
  static const int halves[] = {2, 3, 4, 6, 8, 12, 16};
  for (int integrator = 0; integrator < (int)FB_INTEGRATOR_COUNT; integrator++) {
    const int first = integrator == FB_INTEGRATOR_RK4 ? fewest : 1;
    for (int k = 0, steps = 0; k < FBB_COUNT(halves) && steps < 4 * fewest; k += 1 + fbb_quick) {
      const int before = steps;
      steps = (first * halves[k] + 1) / 2;
      if (steps == before) {
        continue;
      }
      if (integrator == FB_INTEGRATOR_RK4 && e->basis.elements && k > 0) {
        break; /* its steps are short enough */
      }
      fbb_body_run_timed(&h, c, body, (fb_integrator)integrator, steps);
      if (h.status == FB_ERR_UNSUPPORTED) {
        break;
      }
      e->integrator = stepper_name[integrator];
      e->dt = sample / steps;
      fbb_record(e, &h);
    }
  }
}

static void fbb_climb_body(const fbb_case *c, const fbb_level *level, const fbb_basis *basis)
{
  static fb_shape shape;
  static fb_body body;
  static fb_body_work work;
  fb_body_desc desc;
  fb_status status;
  fbb_entry e = {level->name, "", level->rung, (int)level->effects, *basis, 0, 0, 0};
  fbb_shape_make(&shape, c, basis);
  fbb_body_desc_make(&desc, c, level->effects | (fbb_has_gravity(c) ? (unsigned)FB_EFFECT_GRAVITY : 0u));
  status = fb_body_init(&body, &work, &shape, &desc);
  if (status != FB_ERR_EFFECTS) { /* half of something */
    fbb_check(status, c->name);
    fbb_climb_steps(c, &body, &e);
  }
}

static void fbb_climb_modal(const fbb_case *c)
{
  static const int count[] = {1, 2, 3, 4, 6};
  for (int level = 0; level < FBB_COUNT(fbb_levels); level++) {
    const fbb_level *const l = &fbb_levels[level];
    for (int i = 0; i < FBB_COUNT(count); i++) {
      for (int planes = 1; planes < 4; planes++) { /* y, z, both */
        const fbb_basis basis = fbb_modes_of(c, planes & 1 ? count[i] : 0, planes & 2 ? count[i] : 0);
        const int rigid = l->effects == FB_EFFECTS_RIGID;
        if ((planes & 1) <= c->y && planes / 2 <= c->z && !(rigid && (i > 0 || planes < (c->y | 2 * c->z)))) {
          fbb_climb_body(c, l, &basis);
        }
      }
    }
  }
}

static void fbb_climb_strain(const fbb_case *c)
{
  static const fbb_level strain = {"strain", FBB_STRAIN, FB_EFFECTS_STRAIN};
  for (int elements = 1; elements <= 3 && c->root == FB_ROOT_CLAMPED; elements++) {
    const fbb_basis basis = {2 * elements * c->y, 2 * elements * c->z, elements, 0, 0, 0};
    fbb_climb_body(c, &strain, &basis);
  }
}

static const fbb_level fbb_large = {"large", FBB_LARGE, FB_EFFECTS_LARGE};

/* Geometrically exact bodies of a basis with several numbers of points, by what they are more than modes of a plane. */
static void fbb_climb_points(const fbb_case *c, const fbb_basis *basis)
{
  static const int more[] = {2, 3, 5, 7};
  for (int k = fbb_quick; k < FBB_COUNT(more); k++) {
    fbb_basis b = *basis;
    b.points = (b.y > b.z ? b.y : b.z) + more[k];
    fbb_climb_body(c, &fbb_large, &b);
  }
}

/* With y and z modes, as the scene suggests also those of its spin and of loads on the tip. */
static void fbb_climb_bases(const fbb_case *c, int y, int z)
{
  const double spin = fbb_modes_spin(c);
  const int tip = fbb_tip_loads(c), loads = (y > 1 ? tip & 1 : 0) + (z > 1 ? tip & 2 : 0);
  for (int kind = 0; kind < 4; kind++) { /* 1: of the spin, 2: of loads */
    const fbb_basis basis = {y, z, 0, kind & 2 ? loads : 0, 0, kind & 1 ? spin : 0.0};
    if (!(kind & 1 && spin == 0.0) && !(kind & 2 && loads == 0)) {
      fbb_climb_points(c, &basis);
    }
  }
}

/* 1 to 6 modes in a plane, and where both bend and differ in stiffness, different numbers up to 4. */
static void fbb_climb_large(const fbb_case *c)
{
  for (int y = 0; y <= 6 * c->y; y++) {
    for (int z = 0; z <= 6 * c->z; z++) {
      const int apart = y > 0 && z > 0 && y != z;
      if (y + z > 0 && !(apart && (y > 4 || z > 4 || c->EI_y == c->EI_z))) {
        fbb_climb_bases(c, y, z);
      }
    }
  }
}

/* A second reference, by other equations and other functions: a geometrically exact body of many modes, of a scene with
   spin or tip loads those of them, and steps an eighth of the limit. */
static void fbb_second_make(fbb_history *second, const fbb_case *c)
{
  static fb_shape shape;
  static fb_body body;
  static fb_body_work work;
  const int n = c->y && c->z ? 10 : 12;
  const fbb_basis basis = {c->y * n, c->z * n, 0, fbb_tip_loads(c), 0, fbb_modes_spin(c)};
  const double sample = c->duration / FBB_SAMPLES;
  fb_body_desc desc;
  fbb_shape_make(&shape, c, &basis);
  fbb_body_desc_make(&desc, c, FB_EFFECTS_LARGE | (fbb_has_gravity(c) ? (unsigned)FB_EFFECT_GRAVITY : 0u));
  fbb_check(fb_body_init(&body, &work, &shape, &desc), c->name);
  fbb_body_run(second, c, &body, FB_INTEGRATOR_RK4,
               (int)ceil(8 * sample / (double)fb_rk4_limit(&body, (fb_real)fbb_largest_spin(c), 0)));
  fbb_check(second->status, c->name);
}

static int fbb_by_cost(const void *a, const void *b)
{
  const double x = ((const fbb_entry *)a)->ns_per_s, y = ((const fbb_entry *)b)->ns_per_s;
  return (x > y) - (x < y);
}

/* All of it, by cost, against the exact beam; `quick`: less of it, against the second reference, which takes seconds
   where the exact beam takes up to a minute. Returns how far the exact beam is estimated to be off; second_off: how
   far the second reference is from it. */
static double fbb_climb(double *second_off, const fbb_case *c, int quick)
{
  static fbb_history second;
  double off = 0.0;
  fbb_n_entry = 0;
  fbb_quick = quick;
  fbb_second_make(&second, c);
  fbb_reference = second;
  if (!quick) {
    off = fbb_reference_make(c);
  }
  *second_off = fbb_difference(&second, &fbb_reference);
  fbb_climb_exact(c);
  fbb_climb_modal(c);
  fbb_climb_strain(c);
  fbb_climb_large(c);
  qsort(fbb_entries, (size_t)fbb_n_entry, sizeof fbb_entries[0], fbb_by_cost);
  return off;
}

/* The cheapest that errs less than the tolerance; NULL: none does. */
static const fbb_entry *fbb_cheapest(double tolerance)
{
  for (int k = 0; k < fbb_n_entry; k++) {
    if (fbb_entries[k].error <= tolerance) {
      return &fbb_entries[k];
    }
  }
  return NULL;
}

#endif
