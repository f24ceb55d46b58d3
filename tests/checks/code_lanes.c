/* The lanes of a generated step against its single steps, bit for bit: each lane its own state, loads and parameters (code.sh,
   which generates code.h with --lanes, and with --vary where VARY is defined; code_tree.sh: TREE, and ROOT, its free body; SDIRK, HELD, RESTLESS). A lane that is refused tells the status of the
   single step and stays as it was, the others go on. Also C++11. */
#define generated_IMPLEMENTATION
#include "code.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { STEPS = 300 };

static generated_state single[generated_LANES];
static generated_lanes_state lanes;
#ifdef VARY
static generated_model model[generated_LANES];
static generated_lanes_model lanes_model;
#define GIVEN(k) &model[k],
#define LANES &lanes_model,
#else
#define GIVEN(k)
#define LANES
#endif
typedef generated_status status;
#ifndef HELD /* 1: what acts does not change in a step */
#define HELD 0
#endif
#ifdef SDIRK /* which is told the start and the end alone */
#define BY(start, end) start, end
#define FIRST(i, earlier, now) ((i) % 2 || HELD ? (now) : (earlier))
enum { LONG = 100000 };
#else
#define BY(start, end) start, start, end
#define FIRST(i, earlier, now) ((i) % 2 || HELD ? (now) : NULL)
enum { LONG = 10 };
#endif

/* A number from 0 to 1 by lane, step and place. */
static double number(int a, int b, int c)
{
  const double x = 0.37 * a + 0.71 * b + 0.13 * c;
  return x - floor(x);
}

#ifndef LOAD /* range of loads, and of values that are prescribed; a hundredth of it that of states of trees */
#define LOAD 0.1
#endif
#ifdef TREE
/* Place of a number in a struct, which has nothing else. */
static NUMBER *at(void *numbers, int i)
{
  return (NUMBER *)numbers + i;
}

static void begin(void)
{
  for (int k = 0; k < generated_LANES; k++) {
    generated_start(&single[k]);
    for (int i = 0; i < (int)(sizeof single[k] / sizeof(NUMBER)); i++) {
      *at(&single[k], i) += (NUMBER)(1e-2 * LOAD * number(k, i, 0));
    }
    generated_lanes_put(&lanes, k, &single[k]);
  }
}

/* What acts on lane k at step i. */
static void load(generated_input *own, generated_lanes_input *all, int k, int i)
{
  for (int a = 0; a < (int)(sizeof *own / sizeof(NUMBER)); a++) {
    *at(own, a) = *at(all, a * generated_LANES + k) = (NUMBER)(LOAD * (number(k, i, a) - 0.5));
  }
}

/* A number that is refused, in the state of lane k. */
static void spoil(int k)
{
  *at(&single[k], (int)(sizeof single[k] / sizeof(NUMBER)) - 1) = (NUMBER)NAN;
}
#else
/* A number that is refused, in the state of lane k. */
static void spoil(int k)
{
  single[k].q[0] = k % 2 ? (NUMBER)1e6 : (NUMBER)NAN;
}

static void begin(void)
{
  for (int k = 0; k < generated_LANES; k++) {
#ifdef VARY
    generated_parameters own;
    for (int i = 0; i < (int)(sizeof own / sizeof(NUMBER)); i++) {
      const NUMBER x = (NUMBER)(0.9 + 0.2 * number(k, i, 1));
      memcpy((char *)&own + (size_t)i * sizeof x, &x, sizeof x);
    }
    if (generated_model_init(&model[k], &own) != generated_ok) {
      printf("parameters\n");
    }
    generated_lanes_put_model(&lanes_model, k, &model[k]);
#endif
    generated_start(&single[k]);
    for (int i = 0; i < 3; i++) {
      single[k].L[i] = (NUMBER)((PRESCRIBED ? 0 : 9) * number(k, i, 0));
    }
    single[k].q[0] = (NUMBER)(1e-3 * number(k, 0, 0));
    generated_lanes_put(&lanes, k, &single[k]);
  }
}

/* What acts on lane k at step i. */
static void load(generated_input *own, generated_lanes_input *all, int k, int i)
{
  memset(own, 0, sizeof *own);
  for (int a = 0; a < 3; a++) {
    const NUMBER x = (NUMBER)(0.1 * number(k, i, a) - 0.05);
#if PRESCRIBED
    own->w[a] = all->w[a].lane[k] = x;
#else
    own->torque[a] = all->torque[a].lane[k] = x;
#endif
  }
}
#endif

static int same(int k)
{
  generated_state own;
  generated_lanes_take(&own, &lanes, k);
  return memcmp(&own, &single[k], sizeof own) == 0;
}

/* A step of lanes and of single ones. */
static int step(int i, NUMBER dt, int refused)
{
  generated_lanes_input all, earlier;
  status found[generated_LANES], worst;
  int good = 1;
  memset(&all, 0, sizeof all);
  memset(&earlier, 0, sizeof earlier);
  for (int k = 0; k < generated_LANES; k++) {
    generated_input own;
    load(&own, &all, k, i);
    load(&own, &earlier, k, i + STEPS);
  }
#ifdef generated_WIDE
  if (refused < 0) { /* by vectors, not one by one */
    const generated_lanes_input *const in[] = {BY(FIRST(i, &earlier, &all), &all)};
    generated_lanes_state copy = lanes;
    good &= generated_lanes_together(LANES & copy, in, dt) == generated_ok;
  }
#endif
  worst = generated_lanes_step(LANES & lanes, BY(FIRST(i, &earlier, &all), &all), dt, found);
  good &= (worst == generated_ok) == (refused < 0);
  for (int k = 0; k < generated_LANES; k++) {
    generated_input own, before;
    status one;
    load(&own, &all, k, i);
    load(&before, &earlier, k, i + STEPS);
    one = generated_step(GIVEN(k) & single[k], BY(FIRST(i, &before, &own), &own), dt);
    good &= found[k] == one && (one == generated_ok) == (k != refused) && same(k);
  }
  if (!good) {
    printf("step %d, lane refused %d: status %d or bits\n", i, refused, (int)worst);
  }
  return good;
}

/* A step that the first lane alone refuses as too long, just so: the vectors notice, too. */
static int limit(void)
{
  double low = 2e-4, high = LONG;
  int good = 1;
  for (int i = 0; i < 60 && high > low * (1 + 1e-5); i++) {
    generated_state copy = single[0];
    const double middle = sqrt(low * high);
    if (generated_step(GIVEN(0) & copy, BY(NULL, NULL), (NUMBER)middle) == generated_ok) {
      low = middle;
    } else {
      high = middle;
    }
  }
  for (int beyond = 0; beyond < 2; beyond++) {
    generated_lanes_state all = lanes;
    const NUMBER dt = (NUMBER)(beyond ? high : low);
    status told[generated_LANES];
    (void)generated_lanes_step(LANES & all, BY(NULL, NULL), dt, told);
    for (int k = 0; k < generated_LANES; k++) {
      generated_state copy = single[k], own;
      good &= generated_step(GIVEN(k) & copy, BY(NULL, NULL), dt) == told[k];
      generated_lanes_take(&own, &all, k);
      good &= memcmp(&own, &copy, sizeof own) == 0;
    }
    good &= (told[0] == generated_ok) == !beyond;
  }
  if (!good) {
    printf("longest step, %g s\n", high);
  }
  return good;
}

#ifdef ROOT
/* Nothing acts; the frame of no lane, of one or of all moves relative to the mass center. */
static int drift(NUMBER dt)
{
  int good = 1;
  for (int moving = -2; moving < generated_LANES && good; moving++) {
    for (int k = 0; k < generated_LANES; k++) {
      for (int i = 0; i < 3; i++) {
        single[k].ROOT.p[i] = (NUMBER)(moving == -1 || moving == k ? 0.3 * number(k, moving + 2, i) - 0.1 : 0);
      }
      generated_lanes_put(&lanes, k, &single[k]);
    }
    for (int i = 0; i < 3; i++) {
      good &= generated_lanes_step(&lanes, BY(NULL, NULL), dt, NULL) == generated_ok;
      for (int k = 0; k < generated_LANES; k++) {
        good &= generated_step(&single[k], BY(NULL, NULL), dt) == generated_ok && same(k);
      }
    }
  }
  if (!good) {
    printf("nothing acts\n");
  }
  return good;
}
#endif

#ifdef RESTLESS
/* Loads on the first lane alone that grow until it is refused with that status: a correction of it is not small, or it turns too
   far in the step. The vectors notice, too. */
static int restless(void)
{
  int good = 1, seen = 0;
  for (double size = 1; size < 1e9; size *= 1.25) {
    generated_lanes_state all;
    generated_lanes_input in;
    status told[generated_LANES];
    begin();
    all = lanes;
    memset(&in, 0, sizeof in);
    for (int k = 0; k < generated_LANES; k++) {
      generated_input own;
      load(&own, &in, k, 1);
      for (int a = 0; a < (int)(sizeof own / sizeof(NUMBER)) && k == 0; a++) {
        *at(&in, a * generated_LANES) *= (NUMBER)size;
      }
    }
    (void)generated_lanes_step(&all, &in, &in, (NUMBER)2e-2, told);
    for (int k = 0; k < generated_LANES; k++) {
      generated_state copy = single[k], mine;
      generated_input own;
      load(&own, &in, k, 1);
      for (int a = 0; a < (int)(sizeof own / sizeof(NUMBER)) && k == 0; a++) {
        *at(&own, a) *= (NUMBER)size;
      }
      good &= generated_step(&copy, &own, &own, (NUMBER)2e-2) == told[k];
      generated_lanes_take(&mine, &all, k);
      good &= memcmp(&mine, &copy, sizeof mine) == 0;
    }
    seen |= told[0] == RESTLESS;
  }
  if (!good || !seen) {
    printf("a load too large, seen: %d\n", seen);
  }
  return good && seen;
}
#endif

int main(void)
{
  const NUMBER dt = (NUMBER)2e-4;
  status told[generated_LANES];
  int good = 1;
  begin();
  for (int i = 0; i < STEPS && good; i++) {
    good = step(i, dt, -1);
  }
  good = good && limit();
#ifdef ROOT
  good = good && drift(dt);
#endif
#ifdef RESTLESS
  good = good && restless();
#endif
  for (int k = 0; k < generated_LANES && good; k++) { /* too far, and not finite */
    const generated_state before = single[k];
    spoil(k);
    generated_lanes_put(&lanes, k, &single[k]);
    good = step(k, dt, k);
    single[k] = before;
    generated_lanes_put(&lanes, k, &single[k]);
    good = good && step(k, dt, -1);
  }
  good = good && generated_lanes_step(LANES NULL, BY(NULL, NULL), dt, NULL) == generated_null;
  good = good && generated_lanes_step(LANES NULL, BY(NULL, NULL), dt, told) == generated_null;
  for (int k = 0; k < generated_LANES; k++) {
    good = good && told[k] == generated_null;
  }
  good = good && generated_lanes_step(LANES & lanes, BY(NULL, NULL), 0, NULL) == generated_value;
  good = good && generated_lanes_step(LANES & lanes, BY(NULL, NULL), LONG, NULL) == generated_step_length;
  for (int k = 0; k < generated_LANES; k++) {
    good = good && same(k);
  }
  return good ? 0 : 1;
}
