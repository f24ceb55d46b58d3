/* The generated step of a model against fb_rk4_step, STEPS steps of a tumbling or driven body (BASE: free, prescribed,
   pinned or hinged), unloaded, loaded, from rest by loads of 1e-9 and in motion of 1e-7 of these; the largest difference
   of each kind of variable relative to its extreme is printed and at most TOLERANCE. Then what is read off the state, and refusals: same status, same state. */
#include "flexbeam.h"
#define generated_IMPLEMENTATION
#include "code.h"
#ifdef VARY
#undef generated_crc
#endif
#include "rom.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FREE 0
#define PRESCRIBED 1
#define PINNED 2
#define HINGED 3
#ifndef BASE
#define BASE FREE
#endif
#ifndef STEPS
#define STEPS 1000
#endif
#ifdef VARY /* fields of generated_parameters, of which MASS is one and number DAMPING the damping; rom.h: described with them */
static generated_model varied;
#define GIVEN &varied,
#define DESCRIBED 0
#else
#define GIVEN
#define DESCRIBED 1
#define MASS 1
#endif
#ifdef ROTORS /* number of rotors; the limit of a step depends on them */
#define DEPENDS 1
#else
#define DEPENDS 0
#endif
#ifndef TOLERANCE
#define TOLERANCE (FB_SINGLE ? 2e-3 : 1e-11)
#endif

typedef struct run {
  fb_state state;
  generated_state own;
  double difference[8], extreme[8]; /* rho, quat, u, L, q, pi, angles and momenta of rotors */
} run;

static double random_number(void)
{
  static unsigned long seed = 12345;
  seed = (1103515245ul * seed + 12345ul) & 0x7ffffffful;
  return (double)seed / 1073741824.0 - 1.0;
}

/* Modes of the library have unit modal mass, those of the generated step keep that of the description. */
static void scale(fb_real *out, const fb_real *x, double by)
{
  for (int a = 0; a < generated.n; a++) {
    out[a] = (fb_real)(by * (double)x[a]);
  }
}

static void take_state(generated_state *own, const fb_state *state)
{
  generated_start(own);
  memcpy(own->rho, state->rho, sizeof own->rho);
  memcpy(own->quat, state->quat, sizeof own->quat);
  memcpy(own->u, state->u, sizeof own->u);
  memcpy(own->L, state->L, sizeof own->L);
#if FB_SINGLE
  memcpy(own->lost_h, state->lost_h, sizeof own->lost_h);
#endif
  scale(own->q, state->q, 1 / sqrt(MASS));
  scale(own->pi, state->pi, sqrt(MASS));
#ifdef ROTORS
  memcpy(own->rotor_angle, state->q + generated.n, sizeof own->rotor_angle);
  memcpy(own->rotor_momentum, state->pi + generated.n, sizeof own->rotor_momentum);
#endif
}

static double amount = 1; /* of loads and of motion */

/* spin below 0: at rest */
static int begin(run *r, double spin)
{
  fb_real v[3], w[3], q_dot[FB_MAX_MODES];
  fb_status status = fb_state_init(&generated, &r->state);
  memset(r->difference, 0, sizeof r->difference);
  memset(r->extreme, 0, sizeof r->extreme);
  r->extreme[0] = 1e-3; /* round-off of the mass center from O */
  for (int i = 0; i < 3; i++) {
    v[i] = BASE >= PINNED ? FB_R(0.0) : BASE == PRESCRIBED ? (fb_real)(0.2 * i) : (fb_real)random_number();
    w[i] = BASE == PRESCRIBED ? (fb_real)(0.1 * i) : (fb_real)(amount * spin * random_number());
    w[i] = BASE == HINGED && i < 2 ? FB_R(0.0) : w[i];
    v[i] = spin < 0 ? FB_R(0.0) : v[i];
    w[i] = spin < 0 ? FB_R(0.0) : w[i];
  }
  for (int a = 0; a < generated.n; a++) {
    const double most = amount * (generated.effects & FB_EFFECT_LARGE_DEFLECTION ? 0.05 : 0.1) *
                        (double)generated.deflection_limit / (generated.n * fmax((double)generated.reach[a], 0.1));
    r->state.q[a] = (fb_real)(spin < 0 ? 0 : most * random_number());
    q_dot[a] = (fb_real)(spin < 0 ? 0 : most * random_number());
  }
#ifdef ROTORS
  for (int a = 0; a < ROTORS; a++) {
    r->state.pi[generated.n + a] = generated.rotor[a].given ? FB_R(2.0) : FB_R(0.0);
  }
#endif
  status = status ? status : fb_state_from_velocity(&generated, &r->state, v, w, q_dot);
#ifdef ROTORS
  for (int a = 0; a < ROTORS; a++) {
    const fb_real speed = (fb_real)(100 * random_number()), angle = (fb_real)(3 * random_number());
    status =
        status || generated.rotor[a].given ? status : fb_state_rotor_set(&generated, &r->state, a, speed, angle, NULL);
  }
#endif
  take_state(&r->own, &r->state);
  return status;
}

static void compare(run *r, int kind, const fb_real *x, const fb_real *y, int n)
{
  for (int i = 0; i < n; i++) {
    const double apart = fabs((double)x[i] - (double)y[i]);
    r->difference[kind] = apart <= r->difference[kind] ? r->difference[kind] : apart; /* a NaN, too */
    r->extreme[kind] = fmax(r->extreme[kind], fabs((double)x[i]));
  }
}

/* Is every member a number, compensation terms, too? */
static int is_finite(const generated_state *own)
{
  double sum = 0;
  fb_real x[sizeof *own / sizeof(fb_real)];
  memcpy(x, own, sizeof x);
  for (size_t i = 0; i < sizeof x / sizeof *x; i++) {
    sum += fabs((double)x[i]);
  }
  return sum <= (double)FB_HUGE;
}

static void compare_all(run *r)
{
  fb_real modes[FB_MAX_MODES];
  compare(r, 0, r->state.rho, r->own.rho, 3);
  compare(r, 1, r->state.quat, r->own.quat, 4);
  compare(r, 2, r->state.u, r->own.u, 3);
  compare(r, 3, r->state.L, r->own.L, 3);
  scale(modes, r->own.q, sqrt(MASS));
  compare(r, 4, r->state.q, modes, generated.n);
  scale(modes, r->own.pi, 1 / sqrt(MASS));
  compare(r, 5, r->state.pi, modes, generated.n);
#ifdef ROTORS
  for (int a = 0; a < ROTORS; a++) { /* angles by their difference within half a turn */
    const double angle = (double)r->state.q[generated.n + a], apart = angle - (double)r->own.rotor_angle[a];
    r->difference[6] = fmax(r->difference[6], fabs(atan2(sin(apart), cos(apart))));
    r->extreme[6] = fmax(r->extreme[6], fabs(angle));
  }
  compare(r, 7, r->state.pi + generated.n, r->own.rotor_momentum, ROTORS);
#endif
}

#ifdef LOADED /* nodes 1 and 2 have loads, too */
static void load_node(fb_input *in, fb_real *force, fb_real *torque, int node, double t)
{
  fb_load *const load = &in->load[in->n_load++];
  load->node = node;
  load->axes = FB_AXES_BODY;
  for (int i = 0; i < 3; i++) {
    force[i] = load->force[i] = (fb_real)(amount * sin(3 * t + i + node));
    torque[i] = load->torque[i] = (fb_real)(amount * 0.5 * cos(t + 2 * i + node));
  }
}
#endif

/* The same to both: hub force and torque in body axes, or motion of the base. */
static void load(fb_input *in, generated_input *own, double t)
{
  memset(in, 0, sizeof *in);
  memset(own, 0, sizeof *own);
  in->n_load = BASE != PRESCRIBED;
  in->load[0].axes = FB_AXES_BODY;
  for (int i = 0; i < 3; i++) {
#if BASE == FREE
    own->force[i] = in->load[0].force[i] = (fb_real)(amount * 20 * sin(t + i));
#endif
#if BASE != PRESCRIBED
    own->torque[i] = in->load[0].torque[i] = (fb_real)(amount * 30 * cos(2 * t + i));
#else
    own->v[i] = in->v[i] = (fb_real)(amount * (0.2 * i + 0.1 * sin(t)));
    own->w[i] = in->w[i] = (fb_real)(amount * (0.1 * i + 0.3 * sin(0.5 * t)));
    own->v_dot[i] = in->v_dot[i] = (fb_real)(amount * 0.1 * cos(t));
    in->w_dot[i] = (fb_real)(amount * 0.15 * cos(0.5 * t));
#endif
  }
#ifdef ROTORS
  for (int r = 0; r < ROTORS; r++) {
    const double motor = amount * (generated.rotor[r].given ? 2 + sin(t + r) : 0.5 * sin(3 * t + r));
    own->rotor_motor[r] = (fb_real)motor;
    in->rotor[r].torque = generated.rotor[r].given ? FB_R(0.0) : (fb_real)motor;
    in->rotor[r].momentum = generated.rotor[r].given ? (fb_real)motor : FB_R(0.0);
  }
#endif
#ifdef LOADED
  load_node(in, own->force_1, own->torque_1, 1, t);
  load_node(in, own->force_2, own->torque_2, 2, t);
#endif
}

/* Has a rotor an imbalance? Then its speed bounds the step. */
static int is_unbalanced(void)
{
  double sum = 0;
  for (int r = 0; r < generated.n_rotor; r++) {
    sum += fabs((double)generated.rotor[r].static_imbalance) + fabs((double)generated.rotor[r].dynamic_imbalance);
  }
  return sum > 0;
}

static double fly(run *r, int loaded)
{
  static fb_rk4_work work;
  fb_input in[3];
  generated_input own[3];
  double worst = 0;
  const fb_real share =
      generated.effects & FB_EFFECT_LARGE_DEFLECTION ? FB_R(0.05) : FB_R(0.15); /* it falls on the way */
  const fb_real limit = fb_rk4_limit(&generated, FB_R(1.0), FB_R(1.0));
  fb_body_limit now;
  const int shorter = is_unbalanced() && fb_body_limit_eval(&generated, &now, &r->state, NULL) == FB_OK;
  const fb_real dt = generated.n > 0 ? share * (shorter ? now.rk4 : limit) : FB_R(0.01);
  for (int k = 0; k < STEPS; k++) {
    fb_status status;
    generated_status same;
    for (int i = 0; i < 3; i++) {
      load(&in[i], &own[i], (k + 0.5 * i) * (double)dt);
    }
    status = fb_rk4_step(&generated, &r->state, &work, loaded ? &in[0] : NULL, loaded ? &in[1] : NULL,
                         loaded ? &in[2] : NULL, dt);
    same =
        generated_step(GIVEN & r->own, loaded ? &own[0] : NULL, loaded ? &own[1] : NULL, loaded ? &own[2] : NULL, dt);
    if (status != FB_OK || (int)same != (int)status || !is_finite(&r->own)) {
      printf("step %d: status %d, generated %d\n", k, (int)status, (int)same);
      return 1;
    }
    compare_all(r);
  }
  for (int kind = 0; kind < 8; kind++) {
    const double relative = r->difference[kind] / (r->extreme[kind] > 0 ? r->extreme[kind] : 1);
    worst = relative <= worst ? worst : relative;
    printf(" %.1e", relative);
  }
  return worst;
}

/* One step of both from r, which both refuse with that status (FB_OK: with the same one, any) and leave as it was. */
static int refused(const run *r, const fb_input *in, const generated_input *own, fb_real dt, fb_status expected)
{
  static fb_rk4_work work;
  run copy = *r;
  const fb_status status = fb_rk4_step(&generated, &copy.state, &work, in, in, in, dt);
  const generated_status same = generated_step(GIVEN & copy.own, own, own, own, dt);
  if (status == FB_OK || (expected != FB_OK && status != expected) || (int)same != (int)status ||
      memcmp(&copy.own, &r->own, sizeof copy.own) != 0) {
    printf("refused: expected %d, library %d, generated %d\n", (int)expected, (int)status, (int)same);
    return 0;
  }
  return 1;
}

/* A step of the length dt from r, which both take or refuse. */
static int alike(const run *r, fb_real dt)
{
  static fb_rk4_work work;
  run copy = *r;
  const fb_status status = fb_rk4_step(&generated, &copy.state, &work, NULL, NULL, NULL, dt);
  const generated_status same = generated_step(GIVEN & copy.own, NULL, NULL, NULL, dt);
  if ((int)status != (int)same) {
    printf("a step below the limit: library %d, generated %d\n", (int)status, (int)same);
  }
  return (int)status == (int)same;
}

/* Does gravity of a center act? */
static int falls(void)
{
  return (generated.effects & FB_EFFECT_CENTRAL_GRAVITY) != 0;
}

/* From the center outward: rates, energy and a step are refused where the library refuses them, as too near. */
static int center_refused(void)
{
  static fb_rk4_work work;
  int seen[2] = {0, 0}, good = 1;
  for (int k = 0; k < 40 && falls() && good; k++) {
    fb_status expected[3];
    generated_status found[3];
    fb_state rate;
    generated_state own_rate;
    run r;
    good = begin(&r, 0.5) == FB_OK;
    for (int i = 0; i < 3; i++) {
      r.state.rho[i] = generated.center[i] + (fb_real)(0.31 * k * (i + 1));
    }
    take_state(&r.own, &r.state);
    expected[0] = fb_body_rates_eval(&generated, &rate, &r.state, NULL);
    found[0] = generated_rates_eval(GIVEN & own_rate, &r.own, NULL);
    expected[1] = FB_OK;
    found[1] = generated_ok;
#if BASE != PRESCRIBED
    {
      fb_energy energy;
      generated_energy own_energy;
      expected[1] = fb_body_energy_eval(&generated, &energy, &r.state, NULL);
      found[1] = generated_energy_eval(GIVEN & own_energy, &r.own);
    }
#endif
    expected[2] = fb_rk4_step(&generated, &r.state, &work, NULL, NULL, NULL, FB_R(1e-4));
    found[2] = generated_step(GIVEN & r.own, NULL, NULL, NULL, FB_R(1e-4));
    for (int f = 0; f < 3; f++) {
      good &= (int)found[f] == (int)expected[f] && (expected[f] == FB_OK || expected[f] == FB_ERR_RANGE);
    }
    seen[expected[0] == FB_OK]++;
  }
  if (!good || (falls() && (seen[0] == 0 || seen[1] == 0))) {
    printf("refusals near the center: %d refused, %d taken\n", seen[0], seen[1]);
    good = 0;
  }
  return good;
}

static int refusals(void)
{
  const int large = (generated.effects & FB_EFFECT_LARGE_DEFLECTION) != 0;
  fb_real limit = fb_rk4_limit(&generated, FB_R(0.0), FB_R(0.0)), small;
  fb_body_limit now;
  run r, far;
  fb_input in;
  generated_input own;
  int good = begin(&r, 0) == FB_OK && fb_body_limit_eval(&generated, &now, &r.state, NULL) == FB_OK;
  limit = large || DEPENDS || falls() ? now.rk4 : limit; /* on the deflection of lines, momenta of rotors, gravity */
  small = FB_R(1e-3) * (generated.n ? limit : FB_R(1.0));
  load(&in, &own, 0);
  good &= refused(&r, NULL, NULL, FB_R(0.0), FB_ERR_VALUE);
  good &= refused(&r, NULL, NULL, -small, FB_ERR_VALUE);
  good &= refused(&r, NULL, NULL, (fb_real)NAN, FB_ERR_VALUE);
  good &= generated.n == 0 || refused(&r, NULL, NULL, FB_R(1.01) * limit, FB_ERR_STEP);
  good &= (!large && DESCRIBED) || alike(&r, (FB_SINGLE ? FB_R(0.99) : FB_R(0.999999)) * limit);
  good &= generated_step(GIVEN NULL, NULL, NULL, NULL, small) == generated_null;
#if BASE != PRESCRIBED
  for (int i = 0; i < 3; i++) { /* a torque that turns the frame too far */
    own.torque[i] = in.load[0].torque[i] = generated.S0[20] / (small * small);
  }
  good &= refused(&r, &in, &own, small, generated.n == 0 ? FB_ERR_STEP : FB_OK);
  own.torque[1] = in.load[0].torque[1] = (fb_real)NAN;
#else
  own.w[1] = in.w[1] = (fb_real)NAN;
#endif
  good &= refused(&r, &in, &own, small, BASE != PRESCRIBED ? FB_ERR_NOT_FINITE : FB_OK);
  far = r;
  for (int a = 0; a < generated.n; a++) {
    const double reach = (double)generated.reach[a];
    far.state.q[a] = large       ? FB_R(1e3) /* an interval of the line turns too far */
                     : reach > 0 ? (fb_real)(1.001 * (double)generated.deflection_limit / reach)
                                 : FB_R(0.0);
  }
  take_state(&far.own, &far.state);
  good &= generated.n == 0 || refused(&far, NULL, NULL, FB_R(0.01) * small, FB_ERR_RANGE);
  r.own.u[1] = r.state.u[1] = (fb_real)NAN;
  return good & refused(&r, NULL, NULL, small, BASE == FREE ? FB_ERR_NOT_FINITE : FB_OK);
}

#ifdef ROTORS
/* Do both refuse a step from r, with any status? */
static int both_refuse(const run *r)
{
  static fb_rk4_work work;
  run copy = *r;
  return fb_rk4_step(&generated, &copy.state, &work, NULL, NULL, NULL, FB_R(1e-4)) != FB_OK &&
         generated_step(GIVEN & copy.own, NULL, NULL, NULL, FB_R(1e-4)) != generated_ok &&
         memcmp(&copy.own, &r->own, sizeof copy.own) == 0;
}

/* The step limit by nutation, at rest but for rotors: the largest step that both take; and angles and momenta that are none. */
static int rotors_refused(void)
{
  static const fb_real none[2] = {(fb_real)NAN, (fb_real)INFINITY};
  fb_body_limit now;
  fb_input in;
  generated_input own;
  run r;
  int good = begin(&r, 0) == FB_OK, moved = 0;
  load(&in, &own, 0.3);
  for (int a = 0; a < ROTORS && good; a++) { /* so much momentum that it bounds the step */
    r.state.pi[generated.n + a] *= FB_R(1e3);
    moved |= generated.rotor[a].given;
  }
  take_state(&r.own, &r.state);
  good = good && fb_body_limit_eval(&generated, &now, &r.state, NULL) == FB_OK;
  good = good && alike(&r, (FB_SINGLE ? FB_R(0.99) : FB_R(0.999999)) * now.rk4);
  good = good && refused(&r, NULL, NULL, FB_R(1.01) * now.rk4, FB_ERR_STEP);
  for (int k = 0; k < 4 && good; k++) {
    run bad;
    good = begin(&bad, 0) == FB_OK;
    (k < 2 ? bad.state.q : bad.state.pi)[generated.n] = none[k % 2];
    take_state(&bad.own, &bad.state);
    good &= (k >= 2 && moved) || both_refuse(&bad);
  }
  own.rotor_motor[0] = in.rotor[0].torque = (fb_real)NAN;
  in.rotor[0].momentum = generated.rotor[0].given ? in.rotor[0].torque : FB_R(0.0);
  good = good && begin(&r, 0) == FB_OK && refused(&r, &in, &own, FB_R(1e-4), FB_ERR_NOT_FINITE);
  if (!good) {
    printf("rotors: limit or refusals\n");
  }
  return good;
}
#endif

/* A state with one number that is none, or too large: what the library refuses is refused, and by what reads off the state
   each that is not finite, always with that status. The step's status may be another than the library's. */
static int spoiled(fb_real bad)
{
  static fb_rk4_work work;
  static const char *const call[5] = {"rates", "motion", "node", "energy", "step"};
  const int size[6] = {3, 4, 3, 3, generated.n, generated.n};
  int good = 1;
  for (int k = 0, kind = 0, i = 0; k < 13 + 2 * generated.n; k++, i++) {
    fb_state rate;
    fb_motion motion, other;
    fb_node_motion node;
    generated_state own_rate;
    generated_motion own, another;
    generated_node own_node;
    fb_status expected[5] = {FB_OK, FB_OK, FB_OK, FB_OK, FB_OK};
    generated_status found[5];
    run r;
    fb_real *const place[6] = {r.state.rho, r.state.quat, r.state.u, r.state.L, r.state.q, r.state.pi};
    for (; i >= size[kind]; kind++) {
      i -= size[kind];
    }
    good &= begin(&r, 0.5) == FB_OK && fb_body_motion_eval(&generated, &motion, &r.state, NULL) == FB_OK &&
            generated_motion_eval(GIVEN & own, &r.own, NULL) == generated_ok;
    place[kind][i] = bad;
    take_state(&r.own, &r.state);
    expected[0] = fb_body_rates_eval(&generated, &rate, &r.state, NULL);
    expected[1] = fb_body_motion_eval(&generated, &other, &r.state, NULL);
    expected[2] = fb_body_node_motion_eval(&generated, &node, &r.state, &motion, 0);
    found[0] = generated_rates_eval(GIVEN & own_rate, &r.own, NULL);
    found[1] = generated_motion_eval(GIVEN & another, &r.own, NULL);
    found[2] = generated_node_eval(GIVEN & own_node, &r.own, &own, 0);
    found[3] = generated_not_finite;
#if BASE != PRESCRIBED
    {
      fb_energy energy;
      generated_energy own_energy;
      expected[3] = fb_body_energy_eval(&generated, &energy, &r.state, NULL);
      found[3] = generated_energy_eval(GIVEN & own_energy, &r.own);
    }
#endif
    expected[4] = fb_rk4_step(&generated, &r.state, &work, NULL, NULL, NULL, FB_R(1e-4));
    found[4] = generated_step(GIVEN & r.own, NULL, NULL, NULL, FB_R(1e-4));
    for (int f = 0; f < 5; f++) {
      const int right = f < 4 ? found[f] == generated_not_finite : (found[f] == generated_ok) == (expected[f] == FB_OK);
      if (!right) {
        printf("%s with %g in number %d of kind %d of the state: library %d, generated %d\n", call[f], (double)bad, i,
               kind, (int)expected[f], (int)found[f]);
        good = 0;
      }
    }
  }
  return good;
}

/* Largest difference of n numbers relative to the largest of them. */
static double apart(const fb_real *x, const fb_real *y, int n)
{
  double most = 0, size = 1e-30;
  for (int i = 0; i < n; i++) {
    most = fmax(most, fabs((double)x[i] - (double)y[i]));
    size = fmax(size, fabs((double)x[i]));
  }
  return most / size;
}

static double rates_apart(const run *r)
{
  fb_input in;
  generated_input own;
  fb_state rate;
  generated_state same;
  double worst = 0;
  load(&in, &own, 0.3);
  if (fb_body_rates_eval(&generated, &rate, &r->state, &in) != FB_OK ||
      generated_rates_eval(GIVEN & same, &r->own, &own) != generated_ok) {
    return 1;
  }
  worst = fmax(worst, apart(rate.rho, same.rho, 3));
  worst = fmax(worst, apart(rate.quat, same.quat, 4));
  worst = fmax(worst, apart(rate.u, same.u, 3));
  worst = fmax(worst, apart(rate.L, same.L, 3));
  scale(same.q, same.q, sqrt(MASS));
  scale(same.pi, same.pi, 1 / sqrt(MASS));
  worst = fmax(worst, apart(rate.q, same.q, generated.n));
#ifdef ROTORS
  worst = fmax(worst, apart(rate.q + generated.n, same.rotor_angle, ROTORS));
  worst = fmax(worst, apart(rate.pi + generated.n, same.rotor_momentum, ROTORS));
#endif
  return fmax(worst, apart(rate.pi, same.pi, generated.n));
}

static double energy_apart(const run *r)
{
#if BASE == PRESCRIBED
  (void)r;
  return 0;
#else
  fb_energy energy;
  generated_energy own;
  fb_input in;
  memset(&in, 0, sizeof in);
#ifdef ROTORS
  for (int a = 0; a < ROTORS; a++) {
    in.rotor[a].momentum = generated.rotor[a].given ? r->state.pi[generated.n + a] : FB_R(0.0);
  }
#endif
  if (fb_body_energy_eval(&generated, &energy, &r->state, &in) != FB_OK ||
      generated_energy_eval(GIVEN & own, &r->own) != generated_ok) {
    return 1;
  }
  return fmax(apart(&energy.kinetic, &own.kinetic, 1),
              fmax(apart(&energy.strain, &own.strain, 1), apart(&energy.gravity, &own.gravity, 1)));
#endif
}

/* Motion of O and of all nodes. */
static double nodes_apart(const run *r)
{
  fb_motion motion;
  fb_input in;
  generated_motion own;
  generated_input given;
  fb_real q_dot[FB_MAX_MODES];
  double worst;
  load(&in, &given, 0.3);
  if (fb_body_motion_eval(&generated, &motion, &r->state, &in) != FB_OK ||
      generated_motion_eval(GIVEN & own, &r->own, &given) != generated_ok) {
    return 1;
  }
  scale(q_dot, own.q_dot, sqrt(MASS));
  worst = fmax(apart(motion.v, own.v, 3), fmax(apart(motion.w, own.w, 3), apart(motion.q_dot, q_dot, generated.n)));
#ifdef ROTORS
  worst = fmax(worst, apart(motion.rotor_speed, own.rotor_speed, ROTORS));
#endif
  for (int k = 0; k < generated.n_node; k++) {
    fb_node_motion node;
    generated_node same;
    if (fb_body_node_motion_eval(&generated, &node, &r->state, &motion, k) != FB_OK ||
        generated_node_eval(GIVEN & same, &r->own, &own, k) != generated_ok) {
      return 1;
    }
    worst = fmax(worst, fmax(apart(node.position, same.position, 3), apart(node.quat, same.quat, 4)));
    worst = fmax(worst, fmax(apart(node.velocity, same.velocity, 3), apart(node.angular_rate, same.angular_rate, 3)));
  }
  return generated_node_eval(GIVEN NULL, NULL, NULL, 0) == generated_null ? worst : 1;
}

#ifdef VARY
/* Parameters that there cannot be are refused, NULL are those of the description. */
static int parameters(void)
{
  static const generated_parameters given = {VARY};
  static const fb_real none[4] = {(fb_real)-1, FB_R(1e-7), FB_R(1e7), (fb_real)NAN};
  const fb_real *const first = (const fb_real *)&given;
  run r;
  int good = generated_model_init(NULL, &given) == generated_null &&
             generated_model_init(&varied, NULL) == generated_ok && !(fabs((double)varied.mass - 1) > 0);
  for (int k = 0; k < (int)(sizeof given / sizeof *first); k++) {
    for (int i = 0; i < 4; i++) {
      generated_parameters other = given;
      memcpy((char *)&other + (size_t)k * sizeof *first, &none[i], sizeof *first);
      good &= generated_model_init(&varied, &other) == (i == 1 && k == DAMPING ? generated_ok : generated_value);
    }
  }
  good &= generated_model_init(&varied, &given) == generated_ok && begin(&r, 0) == FB_OK &&
          generated_step(NULL, &r.own, NULL, NULL, NULL, FB_R(1e-4)) == generated_null;
  if (!good) {
    printf("parameters\n");
  }
  return good;
}
#endif

int main(void)
{
  double worst = 0;
#ifdef VARY
  if (!parameters()) {
    return 1;
  }
#endif
  const int large = (generated.effects & FB_EFFECT_LARGE_DEFLECTION) != 0; /* strains of lines are differences */
  static const double amounts[] = {1, 1, 1e-9, 1e-7};
  for (int loaded = 0; loaded < (large ? 2 : 4); loaded++) {
    run r;
    amount = amounts[loaded];
    if (begin(&r, loaded == 2 ? -1.0 : 0.5) != FB_OK) {
      printf("no start\n");
      return 1;
    }
#if FB_SINGLE
    if (loaded == 3 && BASE != PRESCRIBED) { /* the attitude is turned onto the angular momentum */
      r.state.lost_h[0] += FB_R(1e-4) * r.state.L[1];
      take_state(&r.own, &r.state);
    }
#endif
    worst = fmax(worst, fly(&r, loaded));
    if (loaded >= 2 && FB_SINGLE) { /* rates are differences of what is rounded */
      printf("\n");
      continue;
    }
    take_state(&r.own, &r.state);
    printf(" | %.1e %.1e %.1e\n", rates_apart(&r), energy_apart(&r), nodes_apart(&r));
    worst = fmax(worst, fmax(rates_apart(&r), fmax(energy_apart(&r), nodes_apart(&r))));
  }
  amount = 1;
  printf(" worst %.1e\n", worst);
  if ((int)generated.base != BASE || (DESCRIBED && generated_crc != fb_body_crc(&generated))) {
    printf("base or check word\n");
    return 1;
  }
  if (!spoiled((fb_real)NAN) || !spoiled(-(fb_real)INFINITY) || !spoiled(FB_R(10.0) * FB_HUGE)) {
    return 1;
  }
#ifdef ROTORS
  if (!rotors_refused()) {
    return 1;
  }
#endif
  return refusals() && center_refused() && worst <= TOLERANCE ? 0 : 1;
}
