/* campbell - flap and lag frequencies of a rotating cantilever over a range of spins, as CSV.
   The beam turns steadily about z with its root at the hub radius; the modal model with the quadratic displacement field is
   linearized about that state numerically (its rates are linear in q there, so differences are exact).
   Exit: 0 well, 1 the model failed, 2 bad options. */
#define FB_MAX_MODES 24
#define FB_MAX_ELEMENTS 20
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_SPINS 256

typedef struct options {
  double length, mass, ei, hub_radius, tip_mass; /* [m], [kg], [N m^2], [m], [kg] */
  double spin[MAX_SPINS];                        /* [rad/s] */
  int spins, modes;
} options;

static const char help[] =
    "campbell - frequencies of a rotating cantilever as CSV (spin [rad/s], kind, mode, omega [rad/s])\n"
    "usage: campbell [options] > table.csv\n"
    "  --length L       [m] beam length (10)\n"
    "  --mass M         [kg] beam mass, uniform (12)\n"
    "  --ei EI          [N m^2] bending stiffness, the same in both planes (14004)\n"
    "  --hub-radius R   [m] distance of the root from the axis (0)\n"
    "  --spin A[,B,..]  [rad/s] spins about the axis (0,2,4,6)\n"
    "  --modes K        modes per plane, 1..8 (4)\n"
    "  --tip-mass M     [kg] point mass at the tip (0)\n"
    "  --help           this text\n"
    "flap is out of the plane of rotation, lag in it. Good to 1e-4 up to spin sqrt(m L^3/EI) = 30, 5e-4 with a tip "
    "mass.\n";

static int fail(const char *what, const char *value)
{
  fprintf(stderr, "campbell: %s%s%s (see --help)\n", what, value[0] ? ": " : "", value);
  return 2;
}

/* One number at text, closed by the character end. */
static int read_number(double *x, const char *text, const char *name, double least, int open, const char **end)
{
  char *stop;
  char message[96];
  errno = 0;
  *x = strtod(text, &stop);
  if (stop == text || errno || !isfinite(*x) || (*stop && *stop != ',') || (*stop == ',' && !end)) {
    snprintf(message, sizeof message, "%s wants %s", name, end ? "numbers separated by commas" : "a number");
    return fail(message, text);
  }
  if (*x < least || (open && *x <= least)) {
    snprintf(message, sizeof message, "%s must be %s %g", name, open ? "greater than" : "at least", least);
    return fail(message, text);
  }
  if (end) {
    *end = stop;
  }
  return 0;
}

static int read_spins(options *o, const char *text)
{
  o->spins = 0;
  for (;;) {
    int status;
    if (o->spins == MAX_SPINS) {
      return fail("more than 256 spins", text);
    }
    status = read_number(&o->spin[o->spins++], text, "--spin", -1e6, 0, &text);
    if (status || *text == 0) {
      return status;
    }
    text++;
  }
}

static int read_options(options *o, int argc, char **argv)
{
  for (int i = 1; i < argc; i += 2) {
    const char *name = argv[i];
    const char *text = argv[i + 1];
    double modes;
    int status;
    if (strcmp(name, "--help") == 0) {
      fputs(help, stdout);
      exit(0);
    }
    if (i + 1 == argc) {
      return fail("no such option, or its value is missing", name);
    }
    if (strcmp(name, "--length") == 0) {
      status = read_number(&o->length, text, name, 0, 1, NULL);
    } else if (strcmp(name, "--mass") == 0) {
      status = read_number(&o->mass, text, name, 0, 1, NULL);
    } else if (strcmp(name, "--ei") == 0) {
      status = read_number(&o->ei, text, name, 0, 1, NULL);
    } else if (strcmp(name, "--hub-radius") == 0) {
      status = read_number(&o->hub_radius, text, name, 0, 0, NULL);
    } else if (strcmp(name, "--tip-mass") == 0) {
      status = read_number(&o->tip_mass, text, name, 0, 0, NULL);
    } else if (strcmp(name, "--spin") == 0) {
      status = read_spins(o, text);
    } else if (strcmp(name, "--modes") == 0) {
      status = read_number(&modes, text, name, 1, 0, NULL);
      if (status == 0 && (modes > 8 || modes != floor(modes))) {
        status = fail("--modes wants a whole number from 1 to 8", text);
      }
      o->modes = status == 0 ? (int)modes : 0;
    } else {
      status = fail("unknown option", name);
    }
    if (status) {
      return status;
    }
  }
  return 0;
}

static fb_beam_desc beam_desc;
static fb_body_desc body_desc;
static fb_beam beam;
static fb_modes modes;
static fb_modes_work modes_work;
static fb_shape shape;
static fb_body body;
static fb_body_work body_work;

static fb_status build(const options *o)
{
  fb_modes_desc keep;
  fb_status status;
  beam_desc.length = (fb_real)o->length;
  beam_desc.n_element = FB_MAX_ELEMENTS;
  beam_desc.n_station = 1;
  beam_desc.station[0].mass = (fb_real)(o->mass / o->length);
  beam_desc.station[0].EI_y = beam_desc.station[0].EI_z = (fb_real)o->ei;
  beam_desc.n_lump = 1;
  beam_desc.lump[0].node = FB_MAX_ELEMENTS;
  beam_desc.lump[0].mass = (fb_real)o->tip_mass;
  beam_desc.position[0] = (fb_real)o->hub_radius;
  memset(&keep, 0, sizeof keep);
  keep.count[FB_KIND_BEND_Y] = keep.count[FB_KIND_BEND_Z] = o->modes > 4 ? 12 : 8; /* more than printed */
  for (int s = 0; s < o->spins; s++) { /* shaped for the fastest spin, good for all below */
    keep.spin = (fb_real)fmax((double)keep.spin, fabs(o->spin[s]));
  }
  keep.spin_radius = (fb_real)o->hub_radius;
  body_desc.effects = FB_EFFECTS_FULL;
  body_desc.base = FB_BASE_PRESCRIBED;
  status = fb_beam_init(&beam, &beam_desc);
  status = status ? status : fb_modes_solve(&modes, &modes_work, &beam, &keep);
  status = status ? status : fb_shape_init(&shape, modes.n);
  status = status ? status : fb_shape_add_beam(&shape, 0, &beam, &modes);
  return status ? status : fb_body_init(&body, &body_work, &shape, &body_desc);
}

/* Stiffness about the steady spin of the modes of one kind, -d pi_dot/dq at q_dot = 0; its eigenvalues are omega^2.
   With the spin along z bending in and out of plane has no gyroscopic coupling: the full matrix is this one. */
static fb_status spinning_frequencies(fb_real *omega, fb_kind kind, double spin, int *count)
{
  static fb_real K[FB_MAX_MODES * FB_MAX_MODES], V[FB_MAX_MODES * FB_MAX_MODES];
  fb_state state, up, down;
  fb_input input;
  fb_status status = FB_OK;
  int index[FB_MAX_MODES], n = 0;
  memset(&input, 0, sizeof input);
  input.w[2] = (fb_real)spin;
  for (int a = 0; a < body.n; a++) {
    if (modes.kind[a] == kind) {
      index[n++] = a;
    }
  }
  for (int j = 0; j < n && status == FB_OK; j++) {
    for (int side = 0; side < 2 && status == FB_OK; side++) {
      (void)fb_state_init(&body, &state);
      state.q[index[j]] = side ? FB_R(1.0) : -FB_R(1.0);
      status = fb_state_from_velocity(&body, &state, input.v, input.w, NULL);
      status = status ? status : fb_body_rates(&body, side ? &up : &down, &state, &input);
    }
    for (int i = 0; i < n; i++) {
      K[i * n + j] = FB_R(0.5) * (down.pi[index[i]] - up.pi[index[i]]);
    }
  }
  status = status ? status : fb_eig_sym_solve(omega, V, K, n);
  for (int i = 0; i < n; i++) { /* a negative square is printed as a negative frequency: unstable */
    omega[i] = (fb_real)copysign(sqrt(fabs((double)omega[i])), (double)omega[i]);
  }
  *count = n;
  return status;
}

int main(int argc, char **argv)
{
  static options o = {10, 12, 14004, 0, 0, {0, 2, 4, 6}, 4, 4};
  static const char *const names[] = {"lag", "flap"};
  int bad = read_options(&o, argc, argv);
  fb_status status;
  if (bad) {
    return bad;
  }
  status = build(&o);
  if (status == FB_OK) {
    printf("spin,kind,mode,omega\n");
  }
  for (int s = 0; s < o.spins && status == FB_OK; s++) {
    for (int kind = FB_KIND_BEND_Z; kind >= FB_KIND_BEND_Y && status == FB_OK; kind--) {
      fb_real omega[FB_MAX_MODES];
      int n;
      status = spinning_frequencies(omega, (fb_kind)kind, o.spin[s], &n);
      for (int k = 0; k < n && k < o.modes && status == FB_OK; k++) {
        printf("%.10g,%s,%d,%.12g\n", o.spin[s], names[kind], k + 1, (double)omega[k]);
      }
    }
  }
  if (status != FB_OK) {
    fprintf(stderr, "campbell: %s\n", fb_status_string(status));
    return 1;
  }
  if (fflush(stdout) != 0) {
    fprintf(stderr, "campbell: cannot write the output\n");
    return 1;
  }
  return 0;
}
