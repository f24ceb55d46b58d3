/* balance.h - does a system of bodies have the energy and the angular momentum that went into it? The program sums up
   what does. Include flexbeam.h and check.h before. */
#ifndef BALANCE_H
#define BALANCE_H
#include <math.h>
#include <string.h>

typedef struct balance {
  double energy, momentum[3];           /* [J], [N m s] about the origin, at the beginning */
  double energy_now;                    /* [J] when it was last looked at */
  double work, impulse[3];              /* [J], [N m s] that went in since then */
  double energy_miss, momentum_miss[3]; /* the largest that either was off */
} balance;

static inline void balance_totals(double *energy, double momentum[3], const fb_system *system, const fb_body *model,
                                  fb_system_work *work, const fb_system_state *state, const fb_system_input *input)
{
  fb_energy e;
  fb_momentum m;
  need(fb_system_energy_eval(system, model, work, &e, state, input), "energy");
  need(fb_system_momentum_eval(system, model, work, &m, state, input), "momentum");
  *energy = (double)(e.kinetic + e.strain + e.gravity);
  for (int i = 0; i < 3; i++) {
    momentum[i] = (double)m.angular[i];
  }
}

static inline void balance_begin(balance *b, const fb_system *system, const fb_body *model, fb_system_work *work,
                                 const fb_system_state *state, const fb_system_input *input)
{
  memset(b, 0, sizeof *b);
  balance_totals(&b->energy, b->momentum, system, model, work, state, input);
  b->energy_now = b->energy;
}

static inline void balance_look(balance *b, const fb_system *system, const fb_body *model, fb_system_work *work,
                                const fb_system_state *state, const fb_system_input *input)
{
  double momentum[3];
  balance_totals(&b->energy_now, momentum, system, model, work, state, input);
  b->energy_miss = fmax(b->energy_miss, fabs(b->energy_now - b->energy - b->work));
  for (int i = 0; i < 3; i++) {
    b->momentum_miss[i] = fmax(b->momentum_miss[i], fabs(momentum[i] - b->momentum[i] - b->impulse[i]));
  }
}

/* Adds the impulse of a torque that a body holds in its own axes for dt while it turns from one attitude to another:
   Simpson's rule. */
static inline void balance_add_torque(balance *b, const double torque[3], const fb_real from[4], const fb_real to[4],
                                      double dt)
{
  fb_real between[4], R[9];
  for (int i = 0; i < 4; i++) {
    between[i] = from[i] + to[i];
  }
  need(fb_quat_normalize(between), "attitude");
  for (int k = 0; k < 3; k++) {
    fb_quat_to_mat33(R, k == 0 ? from : k == 1 ? between : to);
    for (int i = 0; i < 9; i++) {
      b->impulse[i / 3] += dt * (k == 1 ? 4 : 1) / 6 * (double)R[i] * torque[i % 3];
    }
  }
}
#endif
