/* fmu_instance.h - instances of an FMU and their saved states: from an allocator, or with FMU_STATIC from static memory,
   then one instance and FMU_STATES saved states at a time. Include fmu_core.h first. */
#ifndef FMU_INSTANCE_H
#define FMU_INSTANCE_H

#if FMU_STATIC
#define FMU_STATES 8
static struct fmu_store {
  int taken, state_taken[FMU_STATES];
  fmu one;
  union {
    fmu_saved saved;
    unsigned char room[FMU_SAVED_MOST];
  } state[FMU_STATES];
} fmu_store;
#endif

/* An instance of zeros; NULL: there is no room. */
static fmu *fmu_take(const fmu_memory_calls *calls)
{
#if FMU_STATIC
  (void)calls;
  if (fmu_store.taken) {
    return NULL;
  }
  clear_memory(&fmu_store, sizeof fmu_store);
  fmu_store.taken = 1;
  return &fmu_store.one;
#else
  fmu *const f = (fmu *)calls->take(1, sizeof *f);
  if (f) {
    fmu_clear(f);
    f->calls = *calls;
  }
  return f;
#endif
}

static void fmu_give(fmu *f)
{
#if FMU_STATIC
  (void)f;
  fmu_store.taken = 0;
#else
  f->calls.give(f);
#endif
}

static fmu_saved *fmu_take_saved(const fmu *f, size_t bytes)
{
#if FMU_STATIC
  (void)f, (void)bytes;
  for (int k = 0; k < FMU_STATES; k++) {
    if (!fmu_store.state_taken[k]) {
      fmu_store.state_taken[k] = 1;
      return &fmu_store.state[k].saved;
    }
  }
  return NULL;
#else
  return (fmu_saved *)f->calls.take(1, bytes);
#endif
}

static void fmu_give_saved(const fmu *f, fmu_saved *saved)
{
#if FMU_STATIC
  (void)f;
  for (int k = 0; k < FMU_STATES; k++) {
    if (saved == &fmu_store.state[k].saved) {
      fmu_store.state_taken[k] = 0;
    }
  }
#else
  f->calls.give(saved);
#endif
}

/* Room for so many bytes in *saved: as it is, or taken anew. */
static fmu_answer fmu_room(fmu *f, fmu_saved **saved, size_t bytes)
{
  if (*saved && !FMU_STATIC && (*saved)->size != bytes) {
    fmu_give_saved(f, *saved);
    *saved = NULL;
  }
  *saved = *saved ? *saved : fmu_take_saved(f, bytes);
  return *saved ? FMU_OK : fmu_refuse(f, FMU_ERROR, "there is no memory for one more saved state");
}

/* Saves the state of f, to *saved or where that is NULL to one taken. */
static fmu_answer fmu_keep(fmu *f, fmu_saved **saved)
{
  fmu_span span[FMU_MAX_SPANS + 1];
  int n = 0;
  fmu_answer answer = f->now.started ? fmu_prepare(f) : FMU_OK;
  const size_t bytes = answer == FMU_OK ? fmu_saved_parts(f, span, &n) : 0;
  answer = answer ? answer : fmu_room(f, saved, bytes);
  if (answer == FMU_OK) {
    fmu_save(f, *saved, span, n, bytes);
  }
  return answer;
}

/* A serialized state into *saved or where that is NULL into one taken. */
static fmu_answer fmu_keep_bytes(fmu *f, fmu_saved **saved, const void *bytes, size_t n)
{
  union {
    fmu_saved saved;
    unsigned char room[FMU_SAVED_MOST];
  } from;
  fmu_answer answer = FMU_OK;
  if (bytes && n >= sizeof from.saved && n <= sizeof from) {
    memcpy(&from, bytes, n);
  }
  if (!bytes || n < sizeof from.saved || n > sizeof from || from.saved.size != n) {
    answer = fmu_refuse(f, FMU_ERROR, "%u bytes are no saved state of this model", (unsigned)n);
  }
  answer = answer ? answer : fmu_saved_check(f, &from.saved);
  answer = answer ? answer : fmu_room(f, saved, n);
  if (answer == FMU_OK) {
    memcpy(*saved, &from, n);
  }
  return answer;
}
#endif
