/* scene_campbell.h - families of a scene: its modes over a parameter, followed by shape, as CSV and Campbell diagram. Include
   plot.h before. See scene_track.h. */
#ifndef SCENE_CAMPBELL_H
#define SCENE_CAMPBELL_H
#include "scene_run.h"
#include "scene_track.h"

#define FAMILY_PARAMETERS 4
#define CAMPBELL_DRAWN 16   /* curves, at most */
#define CAMPBELL_STILL 5    /* the slowest ones, at any rate */
#define CAMPBELL_PER_TURN 6 /* lines per revolution */

typedef struct scene_range { /* of a parameter: n values from..to */
  const char *name;
  double from, to;
  int n;
} scene_range;

typedef struct scene_family { /* a scene that is read anew for each value */
  scene *s;
  const char *path;
  int n_set, n_range, refused;                             /* refused: the text, at the last values */
  scene_setting set[SCENE_PARAMETERS + FAMILY_PARAMETERS]; /* those of the parameters of the family are the last */
  scene_range range[FAMILY_PARAMETERS];
  scene_options options;
} scene_family;

/* NAME FROM TO N. 0; NULL in *why: it is none; else what is wrong. */
static int scene_range_read(scene_range *r, char *const *word, const char **why)
{
  char *end[3];
  double n;
  r->name = word[0];
  r->from = strtod(word[1], &end[0]);
  r->to = strtod(word[2], &end[1]);
  n = strtod(word[3], &end[2]);
  *why = NULL;
  for (int k = 0; k < 3; k++) {
    *why = *end[k] || end[k] == word[k + 1] ? "wants NAME FROM TO N, a parameter of the scene and three numbers" : *why;
  }
  if (!*why && (!isfinite(r->from) || !isfinite(r->to) || !(n >= 1 && n <= 1000) || n > floor(n))) {
    *why = "wants a whole number of values, 1 to 1000, between finite ones";
  }
  r->n = *why ? 0 : (int)n;
  return *why != NULL;
}

static double scene_range_at(const scene_range *r, int k)
{
  return r->n > 1 ? r->from + (r->to - r->from) * k / (r->n - 1) : r->from;
}

/* Says at which values it was. Returns 1. */
static int scene_family_failed(scene_family *f, const double *value)
{
  size_t at = strlen(f->s->message);
  for (int k = 0; k < f->n_range && at < sizeof f->s->message; k++) {
    at += (size_t)snprintf(f->s->message + at, sizeof f->s->message - at, "%s%s = %.6g", k ? ", " : " (at ",
                           f->range[k].name, value[k]);
  }
  if (at + 1 < sizeof f->s->message) {
    strcpy(f->s->message + at, ")");
  }
  return 1;
}

/* The scene with these values, at its start; what may be wrong with it is told once. */
static int scene_family_make(scene_family *f, const double *value)
{
  for (int k = 0; k < f->n_range; k++) {
    f->set[f->n_set + k].name = f->range[k].name;
    f->set[f->n_set + k].value = value[k];
  }
  f->refused = scene_read(f->s, f->path, f->set, f->n_set + f->n_range);
  if (f->refused || scene_make(f->s, &f->options)) {
    return scene_family_failed(f, value);
  }
  f->options.warn = f->options.talk = NULL;
  return 0;
}

/* ---- modes of rest at speed */

#define REST_TOLD 1e-4  /* what is worth a word */
#define REST_COMPARED 6 /* slowest modes of each body that turns */

/* [rad/s], [m] The spin of a body across the line of its first beam, and the distance of its root from the axis. */
static void rest_spin(double spun[2], const scene *s, int b)
{
  static fb_node_motion node[FB_MAX_NODES];
  const int first = s->body[b].n_node;
  double w[3], line[3], across[3], v[3], along;
  spun[0] = spun[1] = 0;
  if (s->body[b].n_drawn < 2 || modal_nodes(node, b) < first + 2 || !(modal_spin(w, s, b) > 0)) {
    return;
  }
  for (int i = 0; i < 3; i++) {
    line[i] = (double)(node[first + 1].position[i] - node[first].position[i]);
    v[i] = (double)node[first].velocity[i];
  }
  modal_unit(line);
  along = modal_dot(w, line);
  modal_cross(across, w, v);
  spun[0] = sqrt(fmax(modal_dot(w, w) - along * along, 0));
  spun[1] = sqrt(modal_dot(across, across)) / modal_dot(w, w);
}

/* Frequencies of the `most` slowest modes that oscillate, of the slower half of them; how many. */
static int rest_frequencies(double omega[SCENE_MODES], scene *s, int most)
{
  static scene_mode mode[SCENE_MODES];
  const int n = modes_solve(s, mode);
  int found = 0, all = 0;
  for (int k = 0; k < n; k++) {
    all += mode[k].damped > 0;
  }
  for (int k = 0; k < n && found < most && 2 * found < all; k++) {
    if (mode[k].damped > 0) {
      omega[found++] = mode[k].undamped;
    }
  }
  return found;
}

/* Bodies that turn and have modes of rest: how far that takes frequencies up, and what mends it. Of two bases the one with
   the lower frequency is nearer to it (Rayleigh-Ritz). The scene is read again, for its modes alone. */
static void scene_tell_rest(scene_family *f, const double *value)
{
  double was[SCENE_MODES], is[SCENE_MODES], worst = 0;
  scene *const s = f->s;
  int n, at = 0, turns = 0, rests = 0;
  for (int b = 0; b < s->n_body; b++) {
    rests |= s->body[b].rests;
  }
  if (!rests || scene_family_make(f, value) || s->is_exact || scene_look(s, 0) != FB_OK) {
    return;
  }
  for (int b = 0; b < s->n_body; b++) {
    if (s->body[b].rests) {
      rest_spin(scene_spun[b], s, b);
      turns += scene_spun[b][0] > 0;
    }
  }
  n = turns ? rest_frequencies(was, s, REST_COMPARED * turns) : 0;
  if (n > 0 && scene_family_make(f, value) == 0 && rest_frequencies(is, s, n) >= n) {
    for (int k = 0; k < n; k++) {
      const double off = was[k] / is[k] - 1;
      at = off > worst ? k : at;
      worst = fmax(worst, off);
    }
  }
  for (int b = 0; b < s->n_body && worst > REST_TOLD; b++) {
    if (scene_spun[b][0] > 0) {
      fprintf(stderr,
              "%s: warning: body %s turns at %.6g rad/s and has modes of rest: %.6g rad/s is %.2g %% too high; a line "
              "`spin "
              "%.6g %.6g` in it, modes good for all speeds up to there, makes it %.6g rad/s\n",
              s->path, s->body[b].name, scene_spun[b][0], was[at], 100 * worst, scene_spun[b][0], scene_spun[b][1],
              is[at]);
    }
  }
  memset(scene_spun, 0, sizeof scene_spun);
}

/* ---- Campbell */

static int campbell_at(void *user, double value, int named, track_row *row)
{
  scene_family *const f = (scene_family *)user;
  return scene_family_make(f, &value) || (track_take(row, f->s, value, named) && scene_family_failed(f, &value));
}

/* A row for each value: the parameter, the spin, of each curve its damped frequency and its growth. */
static void campbell_write(FILE *csv, const track *t, const char *name)
{
  fprintf(csv, "%s,spin [rad/s]", name);
  for (int a = 0; a < t->n_curve; a++) {
    fprintf(csv, ",%s [rad/s],%s growth [1/s]", t->curve[a].name, t->curve[a].name);
  }
  fputs("\n", csv);
  for (int k = 0; k < t->made; k++) {
    fprintf(csv, "%.12g,%.12g", t->value[k], t->spin[k]);
    for (int a = 0; a < t->n_curve; a++) {
      if (t->curve[a].damped[k] >= 0) {
        fprintf(csv, ",%.12g,%.12g", t->curve[a].damped[k], t->curve[a].growth[k] + 0.0);
      } else {
        fputs(",,", csv);
      }
    }
    fputs("\n", csv);
  }
}

/* Where a quantity passes zero between two rows, linearly; NAN: it does not. */
static double campbell_zero(const track *t, int k, double before, double after)
{
  const double part = before / (before - after);
  return (before < 0) != (after < 0) && part >= 0 && part <= 1 ? t->value[k] + part * (t->value[k + 1] - t->value[k])
                                                               : (double)NAN;
}

/* Modes that grow at a value; -1: there are none. */
static int campbell_growing(scene_family *f, double value)
{
  static scene_mode mode[SCENE_MODES];
  const int n = scene_family_make(f, &value) ? -1 : modes_solve(f->s, mode);
  int growing = n < 0 ? -1 : 0;
  for (int k = 0; k < n; k++) {
    growing += mode[k].growth > 0;
  }
  return growing;
}

/* Between a value and one at which more modes grow: where that begins. */
static double campbell_onset(scene_family *f, double stable, double unstable)
{
  const int before = campbell_growing(f, stable);
  for (int k = 0; k < 40; k++) {
    const double middle = 0.5 * (stable + unstable);
    *(campbell_growing(f, middle) > before ? &unstable : &stable) = middle;
  }
  return unstable;
}

/* Where curves meet multiples of the spin, and where they become unstable. */
static void campbell_tell(FILE *out, const track *t, scene_family *f)
{
  const char *const name = f->range[0].name;
  for (int a = 0; a < t->n_curve; a++) {
    const track_curve *const c = &t->curve[a];
    for (int k = 0; k + 1 < t->made && track_twin(t, a) == a; k++) {
      const int grows = c->growth[k + 1] > 0, grew = c->growth[k] > 0;
      for (int m = 1; m <= CAMPBELL_PER_TURN; m++) {
        const double at = campbell_zero(t, k, c->damped[k] - m * t->spin[k], c->damped[k + 1] - m * t->spin[k + 1]);
        if (isfinite(at) && t->spin[k + 1] + t->spin[k] > 0 && c->damped[k + 1] > 0) {
          fprintf(out, "%s meets %d per revolution at %s = %.5g\n", c->name, m, name, at);
        }
      }
      if (grows != grew) {
        fprintf(out, "%s becomes %s at %s = %.8g\n", c->name, grows ? "UNSTABLE" : "stable", name,
                campbell_onset(f, t->value[grows ? k : k + 1], t->value[grows ? k + 1 : k]));
      }
    }
    if (t->made > 0 && c->growth[0] > 0) {
      fprintf(out, "%s is UNSTABLE at %s = %.6g\n", c->name, name, t->value[0]);
    }
  }
}

/* [rad/s] What is drawn where something spins: up to 2.5 times the last line per revolution; 0: all. */
static double campbell_top(const track *t)
{
  double spin = 0;
  for (int k = 0; k < t->made; k++) {
    spin = fmax(spin, t->spin[k]);
  }
  return 2.5 * CAMPBELL_PER_TURN * spin;
}

static double campbell_least(const track *t, int curve_at)
{
  double least = HUGE_VAL;
  for (int k = 0; k < t->made; k++) {
    least = t->curve[curve_at].damped[k] < least ? t->curve[curve_at].damped[k] : least;
  }
  return least;
}

/* Curves that are drawn: no twins, and the slowest ones. */
static int campbell_choose(int drawn[CAMPBELL_DRAWN], const track *t)
{
  const double top = campbell_top(t);
  int n = 0;
  for (int a = 0; a < t->n_curve && n < CAMPBELL_DRAWN; a++) {
    if (track_twin(t, a) == a && (n < CAMPBELL_STILL || !(top > 0) || campbell_least(t, a) < top)) {
      drawn[n++] = a;
    }
  }
  return n;
}

/* In the key: its name, how many are equal, and what it is at the first value where it has another shape there. */
static void campbell_title(char title[96], const track *t, int curve_at)
{
  const track_curve *const c = &t->curve[curve_at];
  int n = 0, length, first = 0;
  while (first + 1 < t->made && t->spin[track_naming(t)] > 0 && !(t->spin[first] > 0)) {
    first++; /* what stands still is named otherwise */
  }
  for (int a = curve_at; a < t->n_curve; a++) {
    n += track_twin(t, a) == curve_at;
  }
  length = snprintf(title, 96, n > 1 ? "%s (%d equal)" : "%s", c->name, n);
  if (c->kind[first][0] && strncmp(c->name, c->kind[first], strlen(c->kind[first])) != 0) {
    snprintf(title + length, 96 - (size_t)length, ", begins as %.24s", c->kind[first]);
  }
}

static double campbell_most(const track *t, const int *drawn, int n)
{
  const double top = campbell_top(t);
  double most = 0, least = 0;
  for (int i = 0; i < n; i++) {
    const int a = drawn[i];
    for (int k = 0; k < t->made; k++) {
      most = t->curve[a].damped[k] > most ? t->curve[a].damped[k] : most;
    }
    least = i < CAMPBELL_STILL ? fmax(least, campbell_least(t, a)) : least;
  }
  return top > 0 ? fmin(1.05 * most, fmax(top, 1.2 * least)) : 1.05 * most;
}

/* A line per revolution has its number where it leaves the picture. */
static void campbell_label(FILE *gnuplot, const track *t, int per, double most)
{
  const double of = per / (2 * function_pi);
  const int last = t->made - 1, above = of * t->spin[last] > 0.96 * most;
  int k = last;
  double part, x;
  while (k > 0 && of * t->spin[k] > most) {
    k--;
  }
  part = k < last ? (most - of * t->spin[k]) / (of * t->spin[k + 1] - of * t->spin[k]) : 0;
  x = k < last ? t->value[k] + part * (t->value[k + 1] - t->value[k]) : t->value[k];
  if (t->spin[last] > 0 && of * t->spin[k] < most) {
    fprintf(gnuplot, "set label '%d/rev' at %.9g,%.9g right offset -1,%s textcolor rgb '#666666' font ',11'\n", per, x,
            above ? most : of * t->spin[last], above ? "-0.8" : "0.5");
  }
}

/* Frequencies in Hz and rad/s over the parameter. */
static void campbell_draw(const track *t, const char *csv, const char *name, const char *words)
{
  int drawn[CAMPBELL_DRAWN], longest = 0, distinct = 0;
  const int n = campbell_choose(drawn, t);
  const double most = campbell_most(t, drawn, n) / (2 * function_pi);
  char svg[512], title[CAMPBELL_DRAWN][96], label[128];
  FILE *gnuplot;
  other_name(svg, sizeof svg, csv, ".svg");
  for (int a = 0; a < t->n_curve; a++) {
    distinct += track_twin(t, a) == a;
  }
  for (int i = 0; i < n; i++) {
    campbell_title(title[i], t, drawn[i]);
    longest = (int)fmax(longest, (double)strlen(title[i]));
  }
  gnuplot = t->made > 1 && most > 0 ? plot_begin(svg, 800 + 10 * longest, 560, stdout) : NULL;
  if (!gnuplot) {
    return;
  }
  fputs("set key outside right top vertical Left reverse samplen 2 noenhanced\nset xlabel ", gnuplot);
  snprintf(label, sizeof label, words[0] ? "%s [%s]" : "%s", name, words);
  put_quoted(gnuplot, label);
  fprintf(gnuplot,
          " noenhanced\nset ylabel 'damped frequency [Hz]'\nset y2label 'damped frequency [rad/s]'\nset y2tics\n"
          "set ytics nomirror\nset autoscale xfix\nset yrange [0:%.9g]\nset y2range [0:%.9g]\n"
          "set datafile missing ''\n",
          most, most * 2 * function_pi);
  for (int per = 1; per <= CAMPBELL_PER_TURN; per++) {
    campbell_label(gnuplot, t, per, most);
  }
  fputs("plot \\\n", gnuplot);
  for (int per = 1; per <= CAMPBELL_PER_TURN && t->spin[t->made - 1] + t->spin[0] > 0; per++) {
    put_quoted(gnuplot, csv);
    fprintf(gnuplot,
            " using 1:($2*%d/(2*pi)) every ::1 with lines linewidth 1 dashtype 3 linecolor rgb '#999999' notitle,\\\n",
            per);
  }
  for (int i = 0; i < n; i++) {
    put_quoted(gnuplot, csv);
    fprintf(gnuplot, " using 1:($%d/(2*pi)) every ::1 with lines linewidth 2 linetype %d dashtype %d title ",
            3 + 2 * drawn[i], 1 + i % 8, 1 + i / 8);
    put_quoted(gnuplot, title[i]);
    fputs(i + 1 < n ? ",\\\n" : "\n", gnuplot);
  }
  plot_end(gnuplot, svg, stdout);
  if (n < distinct) {
    printf("the picture shows the %d slowest of %d curves; all are in %s\n", n, distinct, csv);
  }
}

/* What the scene says of a parameter behind its value. */
static const char *scene_words_of(const scene *s, const char *name)
{
  int k = 0;
  while (k < s->n_parameter && strcmp(s->parameter[k].name, name) != 0) {
    k++;
  }
  return k < s->n_parameter ? s->parameter_words[k] : "";
}

/* The table to that file and its picture beside it; NULL: the table to stdout. A status of main. */
static int scene_campbell(scene_family *f, const char *csv, int talk)
{
  static track t;
  const char *const name = f->range[0].name;
  const int failed = track_all(&t, campbell_at, f, f->range[0].from, f->range[0].to, f->range[0].n);
  FILE *const out = failed ? NULL : csv ? output_open(csv) : stdout;
  int status = 1;
  if (failed) {
    if (failed == 2) {
      scene_fail(f->s, "there is no memory for modes over a parameter");
    }
  } else if (!out) {
    scene_fail(f->s, "cannot write %s: %s", csv, output_why());
  } else {
    campbell_write(out, &t, name);
    status = 0;
    if (csv && !output_is_whole(out, csv)) {
      status = scene_fail(f->s, "cannot write %s: %s%s", csv, strerror(errno), output_left(csv));
    }
    if (status == 0 && csv && talk) {
      campbell_tell(stdout, &t, f);
      campbell_draw(&t, csv, name, scene_words_of(f->s, name));
    }
  }
  if (status == 0) {
    const double fastest = t.value[track_naming(&t)];
    scene_tell_rest(f, &fastest);
  }
  track_free(&t);
  return status;
}

/* ---- linear models over a grid */

typedef struct family_basis { /* the elastic coordinates that the states of all models are */
  int n_body, n_state, coordinate[FB_MAX_LINEAR / 2];
  track_body body[FB_MAX_BODIES];
  double least; /* how much of a function the one has that is taken for it, at least */
} family_basis;

static void family_basis_free(family_basis *of)
{
  for (int b = 0; b < of->n_body; b++) {
    free(of->body[b].shape);
  }
}

/* The basis of the first model. 1: the reason is in s->message. */
static int family_basis_take(family_basis *of, scene *s)
{
  memset(of, 0, sizeof *of);
  of->least = 1;
  of->n_state = plant.linear.n;
  memcpy(of->coordinate, plant.linear.coordinate, sizeof of->coordinate);
  for (int b = 0; b < s->n_body && !s->is_exact; b++) {
    of->n_body++;
    if (!track_functions(&of->body[b], s, b)) {
      return scene_fail(s, "there is no memory for a family of linear models");
    }
  }
  return 0;
}

/* from[a] of a body: the coordinate that does what a does in the basis, and its sign. The best pairs first. */
static void family_pair(int from[FB_MAX_MODES], double sign[FB_MAX_MODES], family_basis *of, int b,
                        const track_body *now)
{
  const track_body *const was = &of->body[b];
  int taken[FB_MAX_MODES] = {0}, done[FB_MAX_MODES] = {0};
  for (int round = 0; round < was->n; round++) {
    double best = -1, way = 1;
    int at = 0, with = 0;
    for (int i = 0; i < was->n; i++) {
      for (int j = 0; j < was->n && !done[i]; j++) {
        double dot = 0, one = 0, other = 0;
        for (int r = 0; r < was->rows; r++) {
          const double x = was->shape[r * was->n + i], y = now->shape[r * now->n + j];
          dot += x * y;
          one += x * x;
          other += y * y;
        }
        dot = one > 0 && other > 0 ? dot / sqrt(one * other) : i == j;
        if (!taken[j] && fabs(dot) > best) {
          best = fabs(dot);
          way = dot < 0 ? -1 : 1;
          at = i;
          with = j;
        }
      }
    }
    from[at] = with;
    sign[at] = way;
    done[at] = taken[with] = 1;
    of->least = fmin(of->least, best);
  }
}

/* Values of the steady state of a body's coordinates, in the order of the basis. */
static void family_order_point(const scene *s, int b, const int *from, const double *sign, int n)
{
  static double was[LINEAR_OUT_POINT];
  char name[2][80];
  for (int k = 0; k < plant.file.n_point; k++) {
    was[k] = plant.file.point[k].value;
  }
  for (int a = 0; a < 2 * n; a++) {
    const char *const end = a < n ? "" : "_rate", *const of = scene_is_system(s) ? s->body[b].name : "";
    int at[2] = {-1, -1};
    for (int i = 0; i < 2; i++) {
      snprintf(name[i], sizeof name[i], "%s%sq%d%s", of, of[0] ? "." : "", 1 + (i ? from[a % n] : a % n), end);
      for (int k = 0; k < plant.file.n_point; k++) {
        at[i] = strcmp(plant.file.point[k].name, name[i]) == 0 ? k : at[i];
      }
    }
    if (at[0] >= 0 && at[1] >= 0) {
      plant.file.point[at[0]].value = sign[a % n] * was[at[1]];
    }
  }
}

/* Puts the states of a linear model into the order and the signs of the basis. */
static void family_order_states(const int *from, const double *sign)
{
  static fb_real A[FB_MAX_LINEAR * FB_MAX_LINEAR], B[FB_MAX_LINEAR * SCENE_OUTPUTS], C[SCENE_OUTPUTS * FB_MAX_LINEAR];
  const int n = plant.linear.n, n_in = plant.file.n_in, n_out = plant.file.n_out;
  copy_memory(A, plant.linear.A, sizeof A);
  copy_memory(B, plant.B, sizeof B);
  copy_memory(C, plant.C, sizeof C);
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) {
      plant.linear.A[n * i + j] = (fb_real)(sign[i] * sign[j]) * A[n * from[i] + from[j]];
    }
    for (int j = 0; j < n_in; j++) {
      plant.B[n_in * i + j] = (fb_real)sign[i] * B[n_in * from[i] + j];
    }
    for (int j = 0; j < n_out; j++) {
      plant.C[n * j + i] = (fb_real)sign[i] * C[n * j + from[i]];
    }
  }
}

/* The model of the present values in the coordinates of the first. 1: the reason is in s->message. */
static int family_order(family_basis *of, scene *s)
{
  int from[FB_MAX_LINEAR];
  double sign[FB_MAX_LINEAR];
  for (int i = 0; i < plant.linear.n; i++) {
    from[i] = i;
    sign[i] = 1;
  }
  if (plant.linear.n != of->n_state || memcmp(plant.linear.coordinate, of->coordinate, sizeof of->coordinate) != 0) {
    return scene_fail(s, "--grid: the models have other states here: %d, while the first has %d", plant.linear.n,
                      of->n_state);
  }
  for (int b = 0; b < of->n_body; b++) {
    int pair[FB_MAX_MODES];
    double way[FB_MAX_MODES];
    track_body now;
    if (!track_functions(&now, s, b)) {
      return scene_fail(s, "there is no memory for a family of linear models");
    }
    family_pair(pair, way, of, b, &now);
    free(now.shape);
    family_order_point(s, b, pair, way, now.n);
    for (int i = 0; i < modal_states(s); i++) {
      const int a = modal_coordinate(s, i) - now.first;
      for (int k = 0; k < modal_states(s) && a >= 0 && a < now.n; k++) {
        if (modal_coordinate(s, k) == now.first + pair[a]) {
          from[modal_state(s, i)] = modal_state(s, k);
          from[modal_momentum(s, i)] = modal_momentum(s, k);
          sign[modal_state(s, i)] = sign[modal_momentum(s, i)] = way[a];
        }
      }
    }
  }
  family_order_states(from, sign);
  return 0;
}

static void family_head(FILE *file, const scene_family *f)
{
  fputs("{\"format\": \"flexbeam linear family 1\",\n\"parameters\": [", file);
  for (int r = 0; r < f->n_range; r++) {
    fprintf(file, "%s\n  {\"name\": \"%s\", \"values\": [", r ? "," : "", f->range[r].name);
    for (int k = 0; k < f->range[r].n; k++) {
      fprintf(file, "%s%.17g", k ? ", " : "", scene_range_at(&f->range[r], k));
    }
    fputs("]}", file);
  }
  fputs("],\n\"models\": [\n", file);
}

/* Linear models over the grid, the last parameter changing first, into one JSON file. A status of main. */
static int scene_linear_family(scene_family *f, const char *name, int talk)
{
  static family_basis basis;
  FILE *const file = output_open(name);
  int count = 1, failed = 0;
  if (!file) {
    return scene_fail(f->s, "cannot write %s: %s", name, output_why());
  }
  for (int r = 0; r < f->n_range; r++) {
    count *= f->range[r].n;
  }
  family_head(file, f);
  for (int k = 0; k < count && !failed; k++) {
    double value[FAMILY_PARAMETERS];
    for (int r = f->n_range - 1, rest = k; r >= 0; r--) {
      value[r] = scene_range_at(&f->range[r], rest % f->range[r].n);
      rest /= f->range[r].n;
    }
    failed = scene_family_make(f, value) || (scene_linearize(f->s) && scene_family_failed(f, value));
    failed = failed || (k == 0 && family_basis_take(&basis, f->s)) || family_order(&basis, f->s);
    if (!failed) {
      fputs(k ? ",\n" : "", file);
      linear_put_json(file, &plant.file);
    }
  }
  if (failed) {
    output_drop(file, name);
  } else {
    fputs("]}\n", file);
    failed = output_is_whole(file, name)
                 ? 0
                 : scene_fail(f->s, "cannot write %s: %s%s", name, strerror(errno), output_left(name));
  }
  if (!failed && basis.least < 0.9) {
    fprintf(stderr,
            "%s: warning: functions of the elastic coordinates change over the grid (%.2f of one is left): do not "
            "interpolate between so distant models\n",
            f->path, basis.least);
  }
  if (!failed && talk) {
    printf("linear models: %d of %d states, %d inputs, %d outputs\n", count, plant.file.n, plant.file.n_in,
           plant.file.n_out);
  }
  family_basis_free(&basis);
  return failed;
}
#endif
