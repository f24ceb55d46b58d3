/* hil_suspects.c - steps of hil_plant that seem slow, more than it keeps: judged by those that took longest. */
int hil_plant_main(int argc, char **argv);
#define main hil_plant_main
#include "../../examples/hil/hil_plant.c" /* NOLINT: what is tested is inside */
#undef main

enum { PERIODS = 1000, SUSPECTS = 108 };

/* Each of the first steps has taken so long as it says, and the rest as good as nothing. */
static record *flown(plant *p, const options *o)
{
  record *const r = record_begin(o);
  const double period = 1e9 * p->period;
  for (long k = 0; r && k < PERIODS; k++) {
    const double now = clock_ns();
    record_time(r, p, k, now, now, k < SUSPECTS ? period * (double)(2 + k * 37 % SUSPECTS) : 1e3);
    r->done++;
  }
  return r;
}

int main(void)
{
  static plant p;
  const options o = {.seconds = 10, .rate = 100};
  double least = HUGE_VAL;
  record *r;
  int well = make_craft() == FB_OK && plant_begin(&p, &o) == FB_OK;
  r = flown(&p, &o);
  if (!well || !r) {
    puts("no plant");
    return 1;
  }
  for (int i = 0; i < MOST_SUSPECTS; i++) {
    least = fmin(least, r->suspect[i].computed / (1e9 * p.period));
  }
  try_suspects(r);
  printf("%ld suspects, the shortest of %d that are kept took %.3g periods; %ld slow\n", r->suspects,
         (int)MOST_SUSPECTS, least, r->by_computation);
  well = r->suspects == SUSPECTS && r->by_computation == 0 && fabs(least - (2 + SUSPECTS - MOST_SUSPECTS)) < 1e-9;
  free(r->late);
  return !well;
}
