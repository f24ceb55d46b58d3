/* firmware - a 1 kHz attitude loop in flight code: a satellite whose model comes from ROM (a header that `reduce` made;
   with -DGENERATED=1 the step that `reduce --code` made: craft.h) is turned by 10 degrees; gyros and a star tracker on
   the hub, wheels that give the torque, a wing that swings. The controller runs the same body as its estimator: what
   the sensors say of the hub turns the estimated one, the wing of the estimate then moves as the real one does, and its
   rates damp it. Run twice, without and with that damper. The plant stands in for the satellite; the controller sees
   its sensors alone. Everything is in static memory, and nothing that builds models is linked. The same program runs on
   the desktop and on a board, bit for bit (the digest). Checks: the attitude at the end within 0.01 degrees; the
   estimate within a tenth of the swing; the swing of the tip at the end with the damper less than a quarter of that
   without. Exit: 0 well, 1 a step failed or a check did. */
#define FLEXBEAM_IMPLEMENTATION
#include "../../flexbeam.h"
#include "board/board.h"
#include "craft.h" /* the satellite: its state, motion and step, made from examples/satellite.txt */

#define PERIODS 40000 /* of 1 ms */
#define REPORT 4000
static const fb_real period = FB_R(0.001);                                 /* [s] */
static const fb_real slew = FB_R(0.17453), slew_time = FB_R(5.0);          /* [rad] about y, [s] */
static const fb_real inertia[3] = {FB_R(300.0), FB_R(530.0), FB_R(550.0)}; /* [kg m^2] about, of the whole */
static const fb_real bandwidth = FB_R(0.3), damping_ratio = FB_R(0.9);     /* [rad/s], of the attitude loop */
static const fb_real follow = FB_R(3.0), wing_damping = FB_R(0.4), turn_limit = FB_R(20.0); /* [rad/s], -, [N m] */

static craft_state plant, estimate; /* all that changes: RAM */
static uint32_t noise;

typedef struct sensors {
  fb_real attitude[4], rate[3]; /* star tracker, gyros [rad/s] */
} sensors;

/* Uniform in (-1, 1), repeatable. */
static fb_real random_number(void)
{
  noise = noise * 1664525u + 1013904223u;
  return (fb_real)((int32_t)(noise >> 8) - 8388608) / FB_R(8388608.0);
}

static fb_status sense(sensors *out)
{
  craft_motion motion;
  const fb_status status = craft_motion_eval(&motion, &plant);
  for (int i = 0; i < 3; i++) {
    out->rate[i] = motion.w[i] + FB_R(2e-5) * random_number();
    out->attitude[i + 1] = plant.quat[i + 1] + FB_R(1e-5) * random_number();
  }
  out->attitude[0] = plant.quat[0];
  return status ? status : fb_quat_normalize(out->attitude);
}

/* Rotation (small) from attitude a to b, in the axes of a. */
static void turn_between(fb_real turn[3], const fb_real a[4], const fb_real b[4])
{
  const fb_real back[4] = {a[0], -a[1], -a[2], -a[3]};
  fb_real q[4];
  fb_quat_mul(q, back, b);
  for (int i = 0; i < 3; i++) {
    turn[i] = FB_R(2.0) * (q[0] < FB_R(0.0) ? -q[i + 1] : q[i + 1]);
  }
}

/* Attitude, rate and acceleration about y that the slew wants at time t: a smooth step. */
static void command(fb_real attitude[4], fb_real *rate, fb_real *acceleration, fb_real t)
{
  const fb_real s = t < slew_time ? t / slew_time : FB_R(1.0);
  const fb_real half = FB_R(0.5) * slew * s * s * s * (FB_R(10.0) - s * (FB_R(15.0) - FB_R(6.0) * s));
  const fb_real h2 = half * half;
  attitude[0] = FB_R(1.0) - h2 / FB_R(2.0) * (FB_R(1.0) - h2 / FB_R(12.0));
  attitude[1] = attitude[3] = FB_R(0.0);
  attitude[2] = half * (FB_R(1.0) - h2 / FB_R(6.0) * (FB_R(1.0) - h2 / FB_R(20.0)));
  *rate = slew / slew_time * FB_R(30.0) * s * s * (FB_R(1.0) - s) * (FB_R(1.0) - s);
  *acceleration = slew / (slew_time * slew_time) * FB_R(60.0) * s * (FB_R(1.0) - s) * (FB_R(1.0) - FB_R(2.0) * s);
}

/* Adds the torque that damps the wing: by the angular momentum that each mode takes from the hub. */
static void damp_wing(fb_real torque[3], const craft_motion *estimated)
{
  for (int a = 0; a < CRAFT_MODES; a++) {
    const struct craft_mode *const mode = &craft_mode[a];
    torque[mode->axis] -= FB_R(2.0) * wing_damping * mode->omega * mode->momentum * estimated->q_dot[a];
  }
}

/* One period of the controller: torque on the hub from the sensors. Steps the estimate with that torque and with what
   draws its hub after the measured one. */
static fb_status control(fb_real torque[3], const sensors *seen, fb_real t, int damp)
{
  craft_motion estimated;
  fb_real wanted[4], error[3], lag[3], drawn[3], rate, acceleration;
  fb_status status = craft_motion_eval(&estimated, &estimate);
  if (status != FB_OK) {
    return status;
  }
  command(wanted, &rate, &acceleration, t);
  turn_between(error, wanted, seen->attitude);
  turn_between(lag, estimate.quat, seen->attitude);
  for (int i = 0; i < 3; i++) {
    const fb_real rate_error = seen->rate[i] - (i == 1 ? rate : FB_R(0.0));
    torque[i] = inertia[i] * ((i == 1 ? acceleration : FB_R(0.0)) - bandwidth * bandwidth * error[i] -
                              FB_R(2.0) * damping_ratio * bandwidth * rate_error);
  }
  if (damp) {
    damp_wing(torque, &estimated);
  }
  for (int i = 0; i < 3; i++) {
    torque[i] = torque[i] > turn_limit ? turn_limit : torque[i] < -turn_limit ? -turn_limit : torque[i];
    drawn[i] = torque[i] + inertia[i] * follow * (follow * lag[i] + FB_R(2.0) * (seen->rate[i] - estimated.w[i]));
  }
  return craft_step(&estimate, drawn, period);
}

/* Displacement of the wing's tip out of its plane [m]. */
static fb_real tip(const craft_state *state)
{
  fb_real u = FB_R(0.0);
  for (int a = 0; a < CRAFT_MODES; a++) {
    u += craft_mode[a].tip * state->q[a];
  }
  return u;
}

static fb_real larger(fb_real a, fb_real b)
{
  b = b < FB_R(0.0) ? -b : b;
  return a > b ? a : b;
}

static uint32_t digest_state(uint32_t digest, const craft_state *state)
{
  const fb_real *const part[6] = {state->rho, state->quat, state->u, state->L, state->q, state->pi};
  const int size[6] = {3, 4, 3, 3, CRAFT_MODES, CRAFT_MODES};
  for (int k = 0; k < 6; k++) {
    for (int i = 0; i < size[k]; i++) {
      uint64_t bits = 0;
#if FB_SINGLE
      uint32_t word;
      memcpy(&word, &part[k][i], sizeof word);
      bits = word;
#else
      memcpy(&bits, &part[k][i], sizeof bits);
#endif
      digest = board_digest(digest, bits, (int)sizeof(fb_real));
    }
  }
  return digest;
}

typedef struct result {
  fb_real swing, miss, error;  /* [m] of the tip, [m] of its estimate, [rad] in the last 10 s */
  uint32_t fewest, most, loop; /* instructions of a plant's step, of a whole period at most */
  uint32_t digest;
} result;

static void report(int k, fb_real error)
{
  board_print_fixed((int32_t)k, 8);
  board_print_fixed((int32_t)(error * FB_R(57.29578e3)), 12);
  board_print_fixed((int32_t)(tip(&plant) * FB_R(1e6)), 14);
  board_print_fixed((int32_t)(tip(&estimate) * FB_R(1e6)), 16);
  board_print("\n");
}

static fb_status run(result *out, int damp)
{
  fb_real torque[3] = {FB_R(0.0), FB_R(0.0), FB_R(0.0)};
  fb_status status = craft_start(&plant);
  estimate = plant; /* assignment is a snapshot */
  out->fewest = 0xFFFFFFFFu;
  out->most = out->loop = 0;
  out->swing = out->miss = out->error = FB_R(0.0);
  out->digest = BOARD_DIGEST;
  noise = 1;
  board_print(damp ? "\nwith the damper\n" : "without the damper\n");
  board_print("     t s   error deg   wing's tip mm   estimated mm\n");
  for (int k = 1; k <= PERIODS && status == FB_OK; k++) {
    sensors seen;
    fb_real wanted[4], error[3], rate, acceleration;
    const fb_real t = (fb_real)k * period;
    uint32_t count;
    status = sense(&seen);
    board_count_start();
    status = status ? status : control(torque, &seen, t, damp);
    count = board_count();
    out->loop = count > out->loop ? count : out->loop;
    board_count_start();
    status = status ? status : craft_step(&plant, torque, period);
    count = board_count();
    out->fewest = count < out->fewest ? count : out->fewest;
    out->most = count > out->most ? count : out->most;
    out->digest = digest_state(digest_state(out->digest, &plant), &estimate);
    command(wanted, &rate, &acceleration, t);
    turn_between(error, wanted, plant.quat);
    if (k > PERIODS - 10000) {
      out->swing = larger(out->swing, tip(&plant));
      out->miss = larger(out->miss, tip(&plant) - tip(&estimate));
      out->error = larger(out->error, error[1]);
    }
    if (k % REPORT == 0) {
      report(k, error[1]);
    }
  }
  return status;
}

static void tell(const char *what, uint32_t value)
{
  board_print(what);
  board_print_unsigned(value, 0);
  board_print("\n");
}

int main(void)
{
  result without, with;
  fb_status status;
  const char *const fault = craft_fault();
  int well;
  if (fault) {
    board_print(fault);
    return 1;
  }
  status = run(&without, 0);
  status = status ? status : run(&with, 1);
  if (status != FB_OK) {
    board_print(fb_status_string(status));
    board_print("\n");
    return 1;
  }
  well =
      with.swing < FB_R(0.25) * without.swing && with.error < FB_R(1.7e-4) && without.miss < FB_R(0.1) * without.swing;
  board_print("\nswing of the tip in the last 10 s [mm]: ");
  board_print_fixed((int32_t)(without.swing * FB_R(1e6)), 0);
  board_print(" without, ");
  board_print_fixed((int32_t)(with.swing * FB_R(1e6)), 0);
  board_print(" with the damper\ndigest of all states, single or double precision: ");
  board_print_hex(without.digest);
  board_print(" ");
  board_print_hex(with.digest);
  board_print("\n");
#if !GENERATED
  tell("model [bytes of ROM] ", (uint32_t)sizeof satellite);
  tell("work [bytes] ", (uint32_t)sizeof craft_work);
#endif
  tell("state [bytes] ", (uint32_t)sizeof plant);
  if (with.most > 0) {
    tell("instructions of a step, fewest ", with.fewest < without.fewest ? with.fewest : without.fewest);
    tell("instructions of a step, most ", with.most > without.most ? with.most : without.most);
    tell("instructions of the controller, most ", with.loop);
    tell("stack [bytes] ", board_stack());
  }
  board_print(well ? "well\n" : "a check failed\n");
  return well ? 0 : 1;
}
