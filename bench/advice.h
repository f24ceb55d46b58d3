/* advice.h - what the library advises for the scenes of case.h, simulated. */
#ifndef FBB_ADVICE_H
#define FBB_ADVICE_H

#include "case.h"

#define FBB_ADVICE_MODES 6 /* in each plane: what is chosen from */

/* What a scene does at most, as an engineer would estimate it: from its drive, with the motion of a rigid body. */
static void fbb_envelope(fb_envelope *e, const fbb_case *c)
{
  const double g = fabs(c->gravity[0]) + fabs(c->gravity[1]) + fabs(c->gravity[2]), mL = c->mass * c->length;
  const double per_turn = c->drive == fbb_drive_shake ? 5.0 : 1.0;
  fbb_drive drive;
  double angle = 0.0;
  memset(e, 0, sizeof *e);
  e->duration = (fb_real)c->duration;
  if (c->drive == fbb_drive_slew || c->drive == fbb_drive_shake) { /* from rest to rest */
    e->lasts = (fb_real)c->period;
  }
  e->frame = (fb_real)(c->duration / FBB_SAMPLES);
  e->frequency = c->period > 0.0 ? (fb_real)(2 * FBB_PI * per_turn / c->period) : FB_HUGE;
  e->smooth = c->drive == fbb_drive_spinup || c->drive == fbb_drive_flap || c->drive == fbb_drive_shake ||
              c->drive == fbb_drive_hit;
  e->node = (c->chord ? FBB_MIDDLE : FBB_TIP) + 1;
  for (int k = 0; k <= 1000; k++) { /* the base, which turns about z alone */
    const double t = 1e-3 * k * c->duration;
    fbb_drive_at(&drive, c, t);
    angle += 1e-3 * c->duration * drive.w[2];
    for (int i = 0; i < 3 && c->base == FB_BASE_PRESCRIBED; i++) {
      const double aside = i == 2 ? 0.0 : (i == 0 ? 1 : -1) * c->gravity[1 - i] * sin(angle);
      const double along = c->gravity[i] * (i == 2 ? 1.0 : cos(angle)) + aside;
      const double felt = fabs(drive.v_dot[i]) + fabs(along);
      e->spin[i] = (fb_real)fmax((double)e->spin[i], fabs(drive.w[i]));
      e->spin_rate[i] = (fb_real)fmax((double)e->spin_rate[i], fabs(drive.w_dot[i]));
      e->acceleration[i] = (fb_real)fmax((double)e->acceleration[i], felt);
    }
    for (int i = 0; i < 3; i++) {
      e->load[0].force[i] = (fb_real)fmax((double)e->load[0].force[i], fabs(drive.force[i]));
      e->load[0].torque[i] = (fb_real)fmax((double)e->load[0].torque[i], fabs(drive.torque[i]));
    }
  }
  e->n_load = 1;
  e->load[0].node = c->at + 1;
  e->load[0].axes = FB_AXES_BODY;
  if (c->base == FB_BASE_HINGED) { /* falls from the horizontal */
    e->acceleration[0] = e->acceleration[1] = (fb_real)g;
    e->spin[2] = (fb_real)sqrt(3 * g / c->length);
    e->spin_rate[2] = (fb_real)(1.5 * g / c->length);
  }
  if (c->base == FB_BASE_FREE) { /* turned by half the load's product with its period */
    const double J = mL * c->length * c->length / (c->root == FB_ROOT_FREE ? 12 : 3) + c->hub_inertia;
    const double arm = c->at == FBB_TIP ? 0.5 * c->length : 0.0, half = 0.5 * c->period;
    const double add[3] = {0, arm * (double)e->load[0].force[2],
                           arm * (double)e->load[0].force[1] + (double)e->load[0].torque[2]};
    for (int i = 0; i < 3; i++) {
      e->spin[i] = (fb_real)(fabs(c->spin[i]) + half * add[i] / J);
    }
  }
}

typedef struct fbb_trial { /* what the library's trials run */
  const fbb_case *c;
  const fb_shape *shape;
  double ns_per_s;
} fbb_trial;

static fb_status fbb_trial_run(void *user, fb_real *output, const fb_advice *candidate)
{
  static fb_shape shape, pointed;
  static fb_body body;
  static fb_body_work work;
  static fbb_history history;
  fbb_trial *const trial = (fbb_trial *)user;
  fbb_basis basis = fbb_modes_of(trial->c, trial->c->y * FBB_ADVICE_MODES, trial->c->z * FBB_ADVICE_MODES);
  const int steps = (int)lround(trial->c->duration / FBB_SAMPLES / (double)candidate->dt);
  fb_body_desc desc;
  fb_status status;
  if (candidate->line_points > 0) {
    basis.points = candidate->line_points;
    fbb_shape_make(&pointed, trial->c, &basis);
  }
  status = fb_shape_select(&shape, candidate->line_points > 0 ? &pointed : trial->shape, candidate->coordinate,
                           candidate->n);
  fbb_body_desc_make(&desc, trial->c, candidate->effects);
  status = status ? status : fb_body_init(&body, &work, &shape, &desc);
  if (status != FB_OK) {
    return status;
  }
  fbb_body_run(&history, trial->c, &body, candidate->integrator, steps);
  trial->ns_per_s = history.ns_per_s;
  for (int k = 0; k < 3 * FBB_SAMPLES; k++) {
    output[k] = (fb_real)history.out[k / 3][k % 3];
  }
  return history.status;
}

#endif
