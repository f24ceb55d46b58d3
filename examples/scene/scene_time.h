/* scene_time.h - how the time of a run is cut into steps: they end at rows, at events and where a function of time
   jumps or bends, so that each sees one piece of it. See scene.h. */
#ifndef SCENE_TIME_H
#define SCENE_TIME_H
#include "scene.h"

#define SCENE_FUNCTIONS (SCENE_LOADS + SCENE_MOTIONS + SCENE_DRIVES + FB_MAX_SPRINGS + SCENE_DISTRIBUTED + SCENE_ROTORS)
#define SCENE_INSTANTS (FUNCTION_ROWS + 3 * SCENE_FUNCTIONS + SCENE_EVENTS)
#define SCENE_STEPS 1e10 /* at most, of a run: hours of the quickest */

struct scene_clock {
  long rows;
  double interval, slack; /* [s]; instants that are nearer than slack are one */
  double longest, part;   /* steps: [s], and [rad] of the fastest that acts, HUGE_VAL: any */
  double steps, taken;    /* of the whole run, as it was planned; the longest [s] */
  int n;                  /* instants, ascending */
  double instant[SCENE_INSTANTS];
};
SCENE_RUNS(struct scene_clock, timing, );

/* A part of an interval in which nothing jumps or bends. */
typedef struct scene_piece {
  double begin, end, dt, steps; /* a whole number: it may be too large for an integer */
} scene_piece;

/* Function k of all that act; NULL: there are no more. */
static const function *scene_function(const scene *s, int k)
{
  const int motion = k - s->n_load, drive = motion - s->n_motion, spring = drive - s->n_drive,
            spread = spring - s->n_spring, rotor = spread - s->n_distributed;
  return k < s->n_load               ? &s->load[k].f
         : motion < s->n_motion      ? &s->motion[motion].f
         : drive < s->n_drive        ? &s->drive[drive].f
         : spring < s->n_spring      ? &s->spring[spring].pull
         : spread < s->n_distributed ? &s->distributed[spread].f
         : rotor < s->n_rotor        ? &s->rotor[rotor].f
                                     : NULL;
}

static int scene_earlier(const void *a, const void *b)
{
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* For rows at equal intervals. */
static void scene_clock_init(const scene *s, long rows)
{
  const function *f;
  timing.rows = rows;
  timing.interval = rows > 0 ? s->duration / (double)rows : 0;
  timing.slack = 1e-9 * timing.interval;
  timing.n = 0;
  for (int k = 0; (f = scene_function(s, k)) != NULL; k++) {
    timing.n += function_instants(f, &s->tables, timing.instant + timing.n);
  }
  for (int k = 0; k < s->n_event; k++) {
    timing.instant[timing.n++] = s->event[k].t;
  }
  qsort(timing.instant, (size_t)timing.n, sizeof *timing.instant, scene_earlier);
}

/* [rad/s] of the fastest that acts at t. */
static double scene_pace(const scene *s, double t)
{
  const function *f;
  double pace = 0;
  for (int k = 0; (f = scene_function(s, k)) != NULL; k++) {
    pace = fmax(pace, function_pace(f, t));
  }
  return pace;
}

/* [rad/s] of the fastest that acts at any time. */
static double scene_fastest(const scene *s)
{
  const function *f;
  double pace = 0;
  for (int k = 0; (f = scene_function(s, k)) != NULL; k++) {
    pace = fmax(pace, function_pace(f, f->t0));
  }
  return pace;
}

/* The first instant after t, or `end`. */
static double scene_instant_after(double t, double end)
{
  int low = 0, high = timing.n;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (timing.instant[middle] <= t + timing.slack) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low < timing.n && timing.instant[low] < end - timing.slack ? timing.instant[low] : end;
}

/* The first of the instants begin, begin + T, .. after t. */
static double scene_series_after(double begin, double T, double t)
{
  double k = fmax(0, floor((t + timing.slack - begin) / T) - 1);
  while (begin + k * T <= t + timing.slack) {
    k++;
  }
  return begin + k * T;
}

/* When a controller samples, or a command of it begins or ends to act, after t. */
static double scene_sample_after(const scene *s, double t)
{
  double next = HUGE_VAL;
  for (int k = 0; k < s->n_control; k++) {
    const scene_control *const d = &s->control[k];
    const struct scene_controlling *const c = &controlling[k];
    next = fmin(next, fmin(scene_series_after(0, d->sample, t), scene_series_after(d->delay, d->sample, t)));
    for (int i = 0; i < c->n; i++) {
      const double due = remembered[d->orders + 3 * ((c->first + i) % d->room)];
      next = due > t + timing.slack ? fmin(next, due) : next;
    }
  }
  return next;
}

/* The length of a piece; one sample is the same wherever it begins, to the last bit. */
static double scene_piece_length(const scene *s, double begin, double end)
{
  for (int k = 0; k < s->n_control; k++) {
    if (fabs(end - begin - s->control[k].sample) <= timing.slack) {
      return s->control[k].sample;
    }
  }
  return end - begin;
}

/* What comes next of the interval from `start` to `last`, of the length timing.interval. */
static scene_piece scene_piece_from(const scene *s, double start, double last, double begin)
{
  scene_piece p;
  double length, sample;
  p.begin = begin;
  p.end = scene_instant_after(begin, last);
  sample = scene_sample_after(s, begin);
  p.end = sample < p.end - timing.slack ? sample : p.end;
  length = begin == start && p.end == last
               ? timing.interval
               : scene_piece_length(s, begin, p.end); /* the same in every row, to the last bit */
  p.dt = fmin(timing.longest, timing.part / scene_pace(s, 0.5 * (begin + p.end)));
  p.steps = fmax(1, ceil(length / p.dt * (1 - 1e-9)));
  p.dt = length / p.steps;
  return p;
}

typedef struct scene_steps { /* of the whole run */
  double count;              /* not finite, or beyond SCENE_STEPS: too many to count, and the rest not of all */
  double longest, turn;      /* [s]; [rad] of the fastest that acts in a step */
} scene_steps;

static scene_steps scene_count_steps(const scene *s)
{
  scene_steps all = {0, 0, 0};
  for (long row = 0; row < timing.rows && all.count <= SCENE_STEPS; row++) {
    const double start = (double)row * timing.interval, last = (double)(row + 1) * timing.interval;
    double t = start;
    while (t < last) {
      const scene_piece p = scene_piece_from(s, start, last, t);
      all.count += p.steps;
      all.longest = fmax(all.longest, p.dt);
      all.turn = fmax(all.turn, p.dt * scene_pace(s, 0.5 * (p.begin + p.end)));
      t = p.end;
    }
  }
  return all;
}
#endif
