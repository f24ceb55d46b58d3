/* Every public function of flexbeam.h called as it should be, then with each pointer NULL in turn, each number argument
   not a number, infinite, huge, negative, each count and index negative or far too large, and each word of each desc,
   input and state overwritten by such a number and by such a count, whatever is there. CONVENTIONS of flexbeam.h says
   what must come of it:
     NULL              FB_ERR_NULL; functions without a status do nothing, numbers are 0 (or as documented); not tried
                       on the arithmetic that is said to take valid pointers
     anything else     a status, and what was to be changed is as before; or FB_OK, and all that was written is finite
   Prints `name calls` of every function; hostile.sh compares the names with the header's. */
#include "hostile.h"

/* Is what the call may change as it was (failed), finite otherwise? */
static int is_kept(const function *f, const call *c, int skip)
{
  for (int k = 0; k < MOST && f->argument[k].role; k++) {
    const argument *a = &f->argument[k];
    const unsigned char *at = k != skip && is_pointer(a) ? (const unsigned char *)c->p[c->role[k]] : NULL;
    if (at && strchr("oO", a->role) && (at[0] != pattern || memcmp(at, at + 1, a->size - 1) != 0)) {
      return 0; /* not every byte is the pattern */
    }
    if (at && strchr("sb", a->role) && memcmp(at, (char *)&kept + ((char *)a->at - (char *)&w), a->size) != 0) {
      return 0;
    }
  }
  return 1;
}

static int is_sound(const function *f, const call *c, int skip)
{
  for (int k = 0; k < MOST && f->argument[k].role; k++) {
    const argument *a = &f->argument[k];
    if (k != skip && strchr("oOsb", a->role) && !is_finite(c->p[c->role[k]], a->size)) {
      return 0;
    }
  }
  return 1;
}

static int n_wrong;

static void wrong(const function *f, const char *what, int at, size_t word, const char *poison)
{
  if (n_wrong++ < 200) {
    printf("WRONG %s, argument %d, byte %d, %s: %s\n", f->name, at + 1, (int)word, poison, what);
  }
}

static const struct poison {
  const char *name;
  int is_whole;
  double value;
} poisons[] = {{"NaN", 0, (double)NAN}, {"infinity", 0, HUGE_VAL}, {"-infinity", 0, -HUGE_VAL}, {"huge", 0, 1e30},
               {"-huge", 0, -1e30},     {"largest", 0, 0},         {"-1.0", 0, -1.0},           {"0.0", 0, 0.0},
               {"-1", 1, -1},           {"1000", 1, 1000},         {"INT_MAX", 1, INT_MAX},     {"INT_MIN", 1, INT_MIN},
               {"300", 1, 300}};
#define SLOW_STEP 9 /* NaN, 1000 */
#define N_POISON ((int)(sizeof poisons / sizeof *poisons))

static fb_real poison_real(const struct poison *poison)
{
  const fb_real largest = FB_SINGLE ? (fb_real)3.4028234e38 : (fb_real)1.7976931348623157e308;
  return strcmp(poison->name, "largest") == 0 ? largest : (fb_real)poison->value;
}

/* The call with what is in c; where: the argument that is spoiled. */
static void judge(const function *f, call *c, int where, size_t word, const char *poison)
{
  const char role = f->argument[where].role;
  const int skip = role == 's' || role == 'i' || role == '?' ? where : -1;
  argument spoiled = f->argument[where];
  static unsigned char before[sizeof w];
  int status;
  if (skip >= 0) {
    memcpy(before, spoiled.at, spoiled.size);
  }
  status = f->call(c->p, c->x, c->i);
  if (strcmp(fb_status_string(status), "unknown status") == 0) {
    wrong(f, "no such status", where, word, poison);
  } else if (status != FB_OK && !is_kept(f, c, skip)) {
    wrong(f, "a failure changed something", where, word, poison);
  } else if (status != FB_OK && skip >= 0 && memcmp(before, spoiled.at, spoiled.size) != 0) {
    wrong(f, "a failure changed it", where, word, poison);
  } else if (status == FB_OK && f->has_status % ARITHMETIC && !is_sound(f, c, skip)) {
    wrong(f, "FB_OK with what is not finite", where, word, poison);
  }
}

/* Every word of a struct by every poison, of a large one by one of them at least: each poison takes every n-th word, from
   the next one on. */
#define MOST_CALLS 5000
static int spoil_words(const function *f, int where)
{
  const argument *a = &f->argument[where];
  const int next = f->has_status == SLOW ? SLOW_STEP : 1;
  const size_t n_poison = f->has_status == SLOW ? (N_POISON - 1) / SLOW_STEP + 1 : N_POISON;
  const size_t share = n_poison * a->size / sizeof(fb_real) / MOST_CALLS + 1;
  const size_t every = share < n_poison ? share : n_poison;
  int calls = 0;
  for (int k = 0; k < N_POISON; k += next) {
    const fb_real real = poison_real(&poisons[k]);
    const int whole = (int)(poisons[k].is_whole ? poisons[k].value : 0);
    const size_t step = poisons[k].is_whole ? sizeof whole : sizeof real;
    for (size_t word = (size_t)k % every * step; word + step <= a->size; word += every * step) {
      call c;
      if (!is_touchable((char *)a->at + word) || !is_touchable((char *)a->at + word + step - 1)) {
        continue;
      }
      prepare(&c, f);
      memcpy((char *)a->at + word, poisons[k].is_whole ? (const void *)&whole : (const void *)&real, step);
      judge(f, &c, where, word, poisons[k].name);
      calls++;
    }
  }
  return calls;
}

/* A number or count of the arguments by every poison of its kind. */
static int spoil_value(const function *f, int where)
{
  const char role = f->argument[where].role;
  int calls = 0;
  for (int k = 0; k < N_POISON; k++) {
    call c;
    if (role == 'c' || poisons[k].is_whole != (role != 'r') || (role == 'z' && poisons[k].value > 0)) {
      continue;
    }
    prepare(&c, f);
    if (role == 'r') {
      c.x[c.role[where]] = poison_real(&poisons[k]);
    } else {
      c.i[c.role[where]] = (int)poisons[k].value;
    }
    judge(f, &c, where, 0, poisons[k].name);
    calls++;
  }
  return calls;
}

/* A NULL pointer: its status, or nothing. */
static void refuse(const function *f, int where)
{
  const char role = f->argument[where].role;
  call c;
  int status;
  prepare(&c, f);
  c.p[c.role[where]] = NULL;
  number = FB_R(0.0);
  status = f->call(c.p, c.x, c.i);
  if (role == '?' || role == 'O') {
    if (status != FB_OK || !is_sound(f, &c, where)) {
      wrong(f, "may be NULL, but is refused", where, 0, fb_status_string((fb_status)status));
    }
  } else if (f->has_status && status != FB_ERR_NULL) {
    wrong(f, "is not refused", where, 0, "NULL");
  } else if (!is_kept(f, &c, where) || fabs((double)number) > 0.0) {
    wrong(f, "does something", where, 0, "NULL");
  }
}

/* Calls of one function, the valid one among them. */
static int attack(const function *f)
{
  int calls = 1;
  call c;
  int status;
  prepare(&c, f);
  status = f->call(c.p, c.x, c.i);
  if (status != FB_OK || !is_sound(f, &c, -1)) {
    printf("WRONG %s: the valid call gives %s\n", f->name, fb_status_string((fb_status)status));
    n_wrong++;
  }
  for (int k = 0; k < MOST && f->argument[k].role; k++) {
    const char role = f->argument[k].role;
    if (is_pointer(&f->argument[k])) {
      if (f->has_status != ARITHMETIC) {
        refuse(f, k);
        calls++;
      }
      calls += strchr("i?sx", role) ? spoil_words(f, k) : 0;
    } else if (strcmp(f->name, "fb_version_string") != 0 && strcmp(f->name, "fb_config_string") != 0 &&
               strcmp(f->name, "fb_build_check") != 0) {
      calls += spoil_value(f, k);
    }
  }
  return calls;
}

int main(int argc, char **argv)
{
  world_fill();
  for (int k = 0; k < (int)(sizeof functions / sizeof *functions); k++) {
    if (argc < 2 || strcmp(argv[1], functions[k].name) == 0) {
      const int calls = attack(&functions[k]);
      printf("%s %d\n", functions[k].name, calls);
    }
  }
  return n_wrong > 0;
}
