/* fmu_instance.h - instances of an FMU and their saved states: from an allocator, or with FMU_STATIC from static memory,
   then one instance and FMU_STATES saved states at a time. Include fmu_core.h first. */
#ifndef FMU_INSTANCE_H
#define FMU_INSTANCE_H

#if FMU_STATIC
#define FMU_STATES 8
static struct fmu_store {
  int taken, state_taken[FMU_STATES];
  fmu one;
  fmu_saved state[FMU_STATES];
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
  memset(&fmu_store, 0, sizeof fmu_store);
  fmu_store.taken = 1;
  return &fmu_store.one;
#else
  fmu *const f = (fmu *)calls->take(1, sizeof *f);
  if (f) {
    memset(f, 0, sizeof *f);
    f->calls = *calls;
  }
  return f;
#endif
}

static void fmu_give(fmu *f)
{
  fmu_plant_close(&f->plant);
#if FMU_STATIC
  (void)f;
  fmu_store.taken = 0;
#else
  f->calls.give(f);
#endif
}

static fmu_saved *fmu_take_saved(const fmu *f)
{
#if FMU_STATIC
  (void)f;
  for (int k = 0; k < FMU_STATES; k++) {
    if (!fmu_store.state_taken[k]) {
      fmu_store.state_taken[k] = 1;
      return &fmu_store.state[k];
    }
  }
  return NULL;
#else
  return (fmu_saved *)f->calls.take(1, sizeof(fmu_saved));
#endif
}

static void fmu_give_saved(const fmu *f, fmu_saved *saved)
{
#if FMU_STATIC
  (void)f;
  for (int k = 0; k < FMU_STATES; k++) {
    if (saved == &fmu_store.state[k]) {
      fmu_store.state_taken[k] = 0;
    }
  }
#else
  f->calls.give(saved);
#endif
}

/* Saves the state of f, to *saved or where that is NULL to one taken. */
static fmu_answer fmu_keep(fmu *f, fmu_saved **saved)
{
  if (!*saved && !(*saved = fmu_take_saved(f))) {
    return fmu_refuse(f, FMU_ERROR, "there is no memory for one more saved state");
  }
  fmu_save(f, *saved);
  return FMU_OK;
}

/* A serialized state into *saved or where that is NULL into one taken. */
static fmu_answer fmu_keep_bytes(fmu *f, fmu_saved **saved, const void *bytes, size_t n)
{
  fmu_saved from;
  const fmu_answer answer = fmu_unpack(f, &from, bytes, n);
  if (answer == FMU_OK && !*saved && !(*saved = fmu_take_saved(f))) {
    return fmu_refuse(f, FMU_ERROR, "there is no memory for one more saved state");
  }
  if (answer == FMU_OK) {
    **saved = from;
  }
  return answer;
}
#endif
