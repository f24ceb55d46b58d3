/* exact_beam.h - one geometrically exact beam, for the examples that bend one. Any consistent units. Include flexbeam.h
   and options.h first. */
#ifndef EXACT_BEAM_H
#define EXACT_BEAM_H

static const double pi = 3.14159265358979324;

static fb_exact_desc beam_desc;
static fb_exact beam;
static fb_exact_work beam_work;
static fb_exact_state beam_state;
static fb_exact_input beam_input;
static fb_exact_node beam_node[FB_MAX_EXACT + 1];

/* Uniform, straight, clamped, nothing acts: stiffness and inertia by their diagonals (axial, shear, shear, twist,
   bending about y, about z). Zero stiffness: rigid. */
static inline void beam_uniform(double length, int elements, const double stiffness[6], const double inertia[6])
{
  memset(&beam_desc, 0, sizeof beam_desc);
  memset(&beam_input, 0, sizeof beam_input);
  beam_desc.length = (fb_real)length;
  beam_desc.n_element = elements;
  beam_desc.n_station = 1;
  for (int i = 0; i < 6; i++) {
    beam_desc.station[0].stiffness[7 * i] = (fb_real)stiffness[i];
    beam_desc.station[0].inertia[7 * i] = (fb_real)inertia[i];
  }
}

static inline fb_status beam_start(void)
{
  const fb_status status = fb_exact_init(&beam, &beam_desc);
  return status ? status : fb_exact_state_init(&beam, &beam_state, &beam_work, &beam_input);
}

/* The steady state under beam_input, from the present one. */
static inline fb_status beam_settle(void)
{
  const fb_status status = fb_exact_trim(&beam, &beam_state, &beam_work, &beam_input);
  return status ? status : fb_exact_nodes_eval(&beam, beam_node, &beam_state);
}

static inline fb_status beam_advance(double dt)
{
  const fb_status status = fb_exact_step(&beam, &beam_state, &beam_work, &beam_input, (fb_real)dt);
  return status ? status : fb_exact_nodes_eval(&beam, beam_node, &beam_state);
}

/* Lag and flap, rotating Euler-Bernoulli cantilevers: mu = omega sqrt(m L^4 / EI) of the first mode at the rate
   eta sqrt(EI / (m L^4)) of the base about z; tests/reference/p02_rotating_uniform.csv, no hub. */
typedef struct beam_spun {
  double eta, flap, lag;
} beam_spun;

static const beam_spun beam_spun_table[] = {{0, 3.5160152685002, 3.5160152685002},
                                            {2, 4.1373195730254, 3.6217969641241},
                                            {5, 6.4495447485687, 4.0738958582405}};

/* How far the first frequency of a beam without stretch, shear and rotary inertia is from that table, at most;
   negative: it has none. */
static inline double beam_spun_error(double length, double mass, double EI, int elements, int flap)
{
  static fb_exact_spectrum spectrum;
  static fb_exact_spectrum_work work;
  const double unit = sqrt(EI / mass) / (length * length), inertia[6] = {mass, mass, mass, 0, 0, 0};
  const double stiffness[6] = {0, 0, 0, 0, flap ? EI : 0, flap ? 0 : EI};
  double worst = 0;
  for (int k = 0; k < (int)(sizeof beam_spun_table / sizeof beam_spun_table[0]); k++) {
    const beam_spun *const known = &beam_spun_table[k];
    fb_status status;
    beam_uniform(length, elements, stiffness, inertia);
    status = beam_start();
    beam_input.w[2] = (fb_real)(known->eta * unit);
    status = status ? status : beam_settle();
    status = status ? status : fb_exact_spectrum_solve(&beam, &work, &spectrum, &beam_state, &beam_input, 1);
    if (status != FB_OK) {
      return -1;
    }
    worst = fmax(worst, fabs((double)spectrum.im[0] / (unit * (flap ? known->flap : known->lag)) - 1));
  }
  return worst;
}

/* A load at the tip; returns it. */
static inline fb_load *beam_tip_load(fb_axes axes)
{
  fb_load *const load = &beam_input.load[beam_input.n_load++];
  load->node = beam_desc.n_element;
  load->axes = axes;
  return load;
}

/* The deformed line as rows "x,y,z" of a CSV, a blank line behind it; then those of branches. */
static inline void beam_write_shape(FILE *csv, int points)
{
  fb_real begin = 0;
  for (int line = 0; line <= beam_desc.n_branch; line++) {
    const fb_real own = line ? beam_desc.branch[line - 1].length : 0, length = own > 0 ? own : beam_desc.length;
    for (int k = 0; k <= points; k++) {
      const fb_real x = begin + length * (fb_real)k / (fb_real)points;
      fb_real p[3], q[4];
      if (line && k == 0) { /* the place before is the tip of another line */
        fprintf(csv, "%.9g,%.9g,%.9g\n", (double)beam_node[beam_desc.branch[line - 1].node].position[0],
                (double)beam_node[beam_desc.branch[line - 1].node].position[1],
                (double)beam_node[beam_desc.branch[line - 1].node].position[2]);
      } else if (fb_exact_point_eval(&beam, p, q, &beam_state, x) == FB_OK) {
        fprintf(csv, "%.9g,%.9g,%.9g\n", (double)p[0], (double)p[1], (double)p[2]);
      }
    }
    fputs("\n", csv);
    begin += length;
  }
}

/* A file for writing, or a message. */
static inline FILE *beam_open(const char *name)
{
  FILE *const file = output_open(name);
  if (!file) {
    fail("cannot write", name);
  }
  return file;
}

/* name without .csv, with another ending */
static inline void beam_file_name(char *out, size_t size, const char *name, const char *ending)
{
  const size_t n = strlen(name);
  const int has = n > 4 && strcmp(name + n - 4, ".csv") == 0;
  snprintf(out, size, "%.*s%s", (int)(has ? n - 4 : n), name, ending);
}
#endif
