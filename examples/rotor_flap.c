/* rotor_flap - how often per revolution the blades of an articulated rotor flap in vacuum.
   The blades, pitch at zero and lag hinges locked, are raised by half a degree on their flap hinges at the offset e and
   let go; the mean height of their tips crosses zero. The shaft turns at a prescribed rate.
   Check: nu^2 = 1 + e S/I of rigid blades (first and second moment S, I of a blade's mass about its hinge), which
   flexible ones nearly have.
   Exit: 0 well, 1 a check failed or the motion left the model, 2 bad options. */
#include "tools/capacities.h" /* of build/flexbeam: larger models than by default */
#define FLEXBEAM_IMPLEMENTATION
#include "../flexbeam.h"
#define PROGRAM "rotor_flap"
#include "common/check.h"
#include "common/articulated_rotor.h"
#include "common/options.h"
#include "common/output.h"

static rotor_data data = {44, 5, 0.25, 5.5, 9000, 130000, 0, 0, 0.27, 5.7, 0.01, 1.225, 0, 0, 0, 0};
static fb_body model[MODELS];
static fb_system rotor;
static fb_system_work work;

static const char help[] =
    "rotor_flap - flap frequency of an articulated rotor in vacuum, per revolution\n"
    "usage: rotor_flap [options]\n"
    "  --offset E        [m] of the hinges, 0.05 to 2.5, the radius is 5 (0.25)\n"
    "  --flap-spring K   [N m/rad] on the flap hinge; a stiff one bends soft blades, which fail the check (0)\n"
    "  --ei-flap EI      [N m^2] bending stiffness of a blade (9000)\n"
    "  --help            this text\n";

static int read_option(void *target, const char *name, const char *text)
{
  rotor_data *const d = target;
  const number_option numbers[] = {{"--offset", &d->offset, 0.05, 2.5},
                                   {"--flap-spring", &d->flap_spring, 0, 1e9},
                                   {"--ei-flap", &d->ei_flap, 1e-3, 1e12}};
  return read_number(numbers, 3, name, text);
}

/* Mean height [m] of the tips. */
static double height(const fb_system_state *state, const fb_system_input *input)
{
  static fb_system_motion motion;
  double sum = 0;
  need(fb_system_motion_eval(&rotor, model, &work, &motion, state, input), "motion");
  for (int k = 0; k < BLADES; k++) {
    const int body = BLADE(k);
    fb_node_motion tip;
    need(fb_body_node_motion_eval(&model[BLADE_MODEL], &tip, &motion.pose[body], &motion.motion[body], TIP), "tip");
    sum += (double)tip.position[2] / BLADES;
  }
  return sum;
}

/* By the upward crossings of the tips in 30 revolutions. */
static double flap_frequency(const fidelity *f)
{
  static fb_system_state state;
  static fb_system_input input, middle, end;
  const int steps = 360; /* per revolution */
  const double dt = 2 * pi / (data.spin * steps);
  fb_link_motion start[1 + 2 * BLADES] = {{.q = {0}}};
  double last, now, first_time = -1, last_time = -1;
  int crossings = 0;
  make_rotor(&rotor, model, &work, &data, f);
  set_drives(&input, &data, 0);
  start[0].speed[0] = input.drive[0].rate[0];
  for (int k = 0; k < BLADES; k++) {
    start[CROSS(k)].value[FLAP] = (fb_real)(0.5 * degree);
  }
  need(fb_system_state_init(&rotor, model, &state, &work, start, &input), "initial state");
  last = height(&state, &input);
  for (int k = 0; k < 30 * steps; k++, last = now) {
    set_drives(&middle, &data, (k + 0.5) * dt);
    set_drives(&end, &data, (k + 1) * dt);
    need(fb_system_rk4_step(&rotor, model, &state, &work, &input, &middle, &end, (fb_real)dt), "step");
    input = end;
    now = height(&state, &input);
    if (last < 0 && now >= 0) {
      last_time = (k + last / (last - now)) / steps;
      first_time = first_time < 0 ? last_time : first_time;
      crossings++;
    }
  }
  return crossings > 1 ? (crossings - 1) / (last_time - first_time) : 0;
}

int main(int argc, char **argv)
{
  const fidelity rigid = {"rigid blades", 0, 0, 0, 0}, flexible = {"flexible blades", 1, 0, 0, 0};
  double nu, stiff, soft;
  output_begin(PROGRAM);
  if (read_all(argc, argv, help, read_option, &data) != 0) {
    return 2;
  }
  nu = closed_form(&data).nu;
  stiff = flap_frequency(&rigid);
  soft = flap_frequency(&flexible);
  printf("flap frequency in vacuum, per revolution: closed form %.5f, rigid blades %.5f, flexible blades %.5f\n", nu,
         stiff, soft);
  check("flap frequency of rigid blades, off the closed form by", stiff / nu - 1, 5e-4);
  check("flap frequency of flexible blades, off the closed form by", soft / nu - 1, 2e-2);
  return misses != 0;
}
