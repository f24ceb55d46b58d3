/* Any sequence of calls of any public functions, of a valid world (tests/checks/hostile.h) whose descs, inputs and
   states are spoiled word by word, with plausible and absurd numbers and counts, and a NULL pointer now and then. What
   a call makes (a beam, modes, a shape, a state) goes into the world, and on into the calls that follow. Bytes: per
   call a function, then how many words are spoiled, then which. */
#include "../checks/hostile.h"
#include "fuzz.h"

static const function *const last = functions + sizeof functions / sizeof *functions;

/* What is made goes on, where it fits what else is there: things of the same size as an object of the world. */
static void go_on(const function *f, const call *c)
{
  const struct {
    const char *maker;
    void *to;
    size_t size;
  } list[] = {{"fb_beam_init", &w.beam[0], sizeof w.beam[0]},
              {"fb_state_init", &w.state, sizeof w.state},
              {"fb_body_motion_eval", &w.motion, sizeof w.motion},
              {"fb_body_node_motion_eval", &w.node_motion, sizeof w.node_motion},
              {"fb_section_init", &w.section, sizeof w.section},
              {"fb_exact_station_init", &w.exact_station, sizeof w.exact_station},
              {"fb_body_spectrum_solve", &w.spectrum, sizeof w.spectrum},
              {"fb_system_spectrum_solve", &w.spectrum, sizeof w.spectrum},
              {"fb_body_init", &w.held, sizeof w.held},
              {"fb_exact_state_init", &w.exact_state, sizeof w.exact_state},
              {"fb_system_state_init", &w.system_state, sizeof w.system_state}};
  for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
    for (int j = 0; j < MOST && f->argument[j].role && strcmp(f->name, list[k].maker) == 0; j++) {
      if (strchr("oO", f->argument[j].role)) {
        memcpy(list[k].to, c->p[c->role[j]], list[k].size);
      }
    }
  }
  if (strcmp(f->name, "fb_beam_init") == 0 &&
      fb_modes_solve(&w.modes, &modes_work, &w.beam[0], &kept.modes_desc) != FB_OK) {
    w.beam[0] = kept.beam[0]; /* beam and modes belong together */
    w.modes = kept.modes;
  }
  if (strcmp(f->name, "fb_body_init") == 0 && (w.held.base != FB_BASE_PRESCRIBED || w.held.n_node < 2)) {
    w.held = kept.held;
  }
}

static void keep_pointers(void)
{
  for (size_t k = 0; k < sizeof untouched / sizeof *untouched; k++) {
    const size_t at = (size_t)((const char *)untouched[k].at - (const char *)&w);
    memcpy((char *)&w + at, (const char *)&kept + at, untouched[k].size);
  }
}

/* Spoils what is data, up to three words, but for pointers. */
static void spoil_arguments(const function *f, call *c, bytes *b)
{
  const int words = take_byte(b) % 4;
  for (int k = 0; k < words; k++) {
    const int j = take_byte(b) % MOST;
    const argument *a = &f->argument[j];
    if (!a->role) {
      continue;
    }
    if (a->role == 'r') {
      c->x[c->role[j]] = take_real(b);
    } else if (a->role == 'n') {
      c->i[c->role[j]] = take_whole(b);
    } else if (strchr("i?s", a->role)) {
      spoil(a->at, a->size, b);
      keep_pointers();
    } else if (a->role == 'o' && f->has_status % ARITHMETIC) {
      c->p[c->role[j]] = NULL;
    }
  }
}

/* Arguments from the world as it is. */
static void aim(call *c, const function *f)
{
  static unsigned char world[sizeof w];
  memcpy(world, &w, sizeof w);
  prepare(c, f); /* which takes them as they were */
  memcpy(&w, world, sizeof w);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  bytes b = {data, size};
  static unsigned char before[sizeof w];
  if (kept.config[0] == 0) {
    world_fill();
  }
  memcpy(&w, &kept, sizeof w);
  for (int calls = 0; calls < 24 && b.left > 0; calls++) {
    const function *const f = functions + take_below(&b, (int)(last - functions));
    call c;
    int status;
    aim(&c, f);
    spoil_arguments(f, &c, &b);
    memcpy(before, &w, sizeof w);
    status = f->call(c.p, c.x, c.i);
    promise(strcmp(fb_status_string(status), "unknown status") != 0, "no such status", f->name);
    for (int j = 0; j < MOST && f->argument[j].role; j++) {
      const argument *a = &f->argument[j];
      const size_t at = a->at ? (size_t)((char *)a->at - (char *)&w) : 0;
      const void *const there = is_pointer(a) ? c.p[c.role[j]] : NULL;
      if (there && strchr("sb", a->role) && status != FB_OK) {
        promise(memcmp(before + at, a->at, a->size) == 0, "a failure changed a state", f->name);
      }
      if (there && strchr("oO", a->role) && status == FB_OK && f->has_status % ARITHMETIC) {
        promise(is_finite(there, a->size), "FB_OK with what is not finite", f->name);
      }
      if (there && a->role == 'x') { /* spoiled: as it was for the next */
        memcpy(a->at, (char *)&kept + at, a->size);
      }
    }
    if (status == FB_OK) {
      go_on(f, &c);
    }
  }
  return 0;
}
