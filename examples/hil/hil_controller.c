/* hil_controller - the flight software of hil_plant's spacecraft as a process of its own: sensors come in and commands
   go out as packets (hil.h) over UDP on the loopback address. It says hello until the plant sends, answers every sensor
   packet, and ends with the plant's run. What it does with them is in hil_control.h: attitude estimated, a slew,
   pointing with a notch. Both have the same key (hil_key.h): who has it not is not answered to.
   Exit: 0 the plant's run ended, 1 no plant came, it has another key, or it fell silent, 2 bad options or no key. */
#define _POSIX_C_SOURCE 200809L /* sockets, clocks */
#define FLEXBEAM_IMPLEMENTATION
#include "../../flexbeam.h"
#define PROGRAM "hil_controller"
#include "../common/clock.h"
#include "hil_link.h"
#include "../common/options.h"
#include "../common/output.h"
#include "hil_key.h"
#include "../common/solar_array.h"
#include "hil_control.h"
#include <signal.h>

enum { MOST_SAMPLES = 65536, MOST_FOREIGN = 10 }; /* -, answers by another key that are enough */

typedef struct options {
  double port, patience, crash_at, priority; /* -, [s], [s], - */
  const char *key;
} options;

static const char help[] =
    "hil_controller - commands the spacecraft of hil_plant by packets on the loopback address\n"
    "usage: hil_controller [options]\n"
    "  --port P      UDP port of the plant on 127.0.0.1 (47800)\n"
    "  --key FILE    32 hexadecimal digits that the plant has, too (the variable HIL_KEY, or else hil.key, which is\n"
    "                made if it is not there)\n"
    "  --patience T  [s] without a packet of the plant, then it ends (30)\n"
    "  --crash-at T  [s] of the plant's time: it kills itself there, for trying the plant's watchdog (never)\n"
    "  --priority P  of SCHED_FIFO, 0: do not ask for it (40)\n"
    "  --help        this text\n";

static int read_option(void *target, const char *name, const char *text)
{
  options *const o = target;
  const number_option numbers[] = {{"--port", &o->port, 1, 65535},
                                   {"--patience", &o->patience, 0.01, 1e4},
                                   {"--crash-at", &o->crash_at, 0, 1e9},
                                   {"--priority", &o->priority, 0, 99}};
  if (strcmp(name, "--key") == 0) {
    o->key = text;
    return 0;
  }
  return read_number(numbers, (int)(sizeof numbers / sizeof numbers[0]), name, text);
}

typedef struct session {
  int link;
  hil_key key;
  struct sockaddr_in plant;
  hil_traffic traffic;
  uint64_t number, plant_number;        /* of this session, of the plant's; the latter 0: not known */
  uint32_t sequence, last;              /* of the last packet sent, of the plant's last sensors */
  int joined, ended;                    /* sensors have come, the plant has said so */
  unsigned char answer[HIL_MOST_BYTES]; /* to the last sensors */
  int bytes;
  long samples;
  double computed[MOST_SAMPLES]; /* [us] of the latest answers */
  double strain[2][2];           /* least and largest reading of the gauges */
  double error;                  /* [rad] of the estimate from the aim, at last */
} session;

static void transmit(session *s, const unsigned char *bytes, int n)
{
  const int sent = link_send(s->link, &s->plant, bytes, n);
  s->traffic.sent += sent;
  s->traffic.unsent += !sent;
}

static void say_hello(session *s)
{
  unsigned char bytes[HIL_MOST_BYTES];
  hil_packet p;
  memset(&p, 0, sizeof p);
  p.type = HIL_HELLO;
  p.sender = s->number;
  p.receiver = s->plant_number;
  p.sequence = ++s->sequence;
  transmit(s, bytes, hil_encode(bytes, &p, &s->key));
}

static double largest(const double x[3])
{
  return fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2])));
}

static void keep_watch(session *s, const controller *c, const hil_packet *p)
{
  double error[3];
  fb_real wanted[4];
  for (int i = 0; i < 2; i++) {
    s->strain[i][0] = fmin(s->strain[i][0], p->value[HIL_STRAIN + i]);
    s->strain[i][1] = fmax(s->strain[i][1], p->value[HIL_STRAIN + i]);
  }
  wanted_attitude(wanted, p->time);
  turn_between(error, wanted, c->estimate.quat);
  s->error = largest(error);
}

static void answer(session *s, controller *c, const hil_packet *sensors)
{
  hil_packet p;
  const double start = clock_ns();
  memset(&p, 0, sizeof p);
  p.type = HIL_COMMAND;
  p.sender = s->number;
  p.receiver = s->plant_number;
  p.sequence = ++s->sequence;
  p.answers = sensors->sequence;
  p.time = sensors->time;
  controller_step(c, p.value, sensors->time, sensors->value);
  s->bytes = hil_encode(s->answer, &p, &s->key);
  transmit(s, s->answer, s->bytes);
  s->computed[s->samples++ % MOST_SAMPLES] = (clock_ns() - start) / 1e3;
  keep_watch(s, c, sensors);
}

/* What the plant sent: its challenge, until it sends sensors. In lock-step it asks again when an answer was lost, with
   the same number: the same answer. */
static hil_verdict take(session *s, controller *c, const hil_packet *p, const struct sockaddr_in *from)
{
  if (!link_same(from, &s->plant)) {
    return HIL_BAD_SENDER;
  }
  if (p->receiver != s->number || (p->type != HIL_CHALLENGE && p->sender != s->plant_number)) {
    return HIL_BAD_SESSION;
  }
  if (p->type == HIL_CHALLENGE && !s->joined) {
    s->plant_number = p->sender;
    say_hello(s);
    return HIL_ACCEPTED;
  }
  if (p->type != HIL_SENSORS && p->type != HIL_END) {
    return HIL_BAD_TYPE;
  }
  if (s->joined && p->type == HIL_SENSORS && p->sequence == s->last) {
    transmit(s, s->answer, s->bytes);
    return HIL_ACCEPTED;
  }
  if (s->joined && p->sequence <= s->last) {
    return HIL_BAD_SEQUENCE;
  }
  s->traffic.lost += s->joined ? (long)(p->sequence - s->last - 1) : 0;
  s->last = p->sequence;
  s->joined = 1;
  s->ended = p->type == HIL_END;
  if (!s->ended) {
    answer(s, c, p);
  }
  return HIL_ACCEPTED;
}

/* What answers there has another key, and nothing from there is signed by this one. */
static int has_other_key(const session *s)
{
  return s->traffic.received == 0 && s->traffic.refused[HIL_BAD_TAG] >= MOST_FOREIGN;
}

static void converse(session *s, controller *c, const options *o)
{
  double heard = clock_ns();
  while (!s->ended && !has_other_key(s) && clock_ns() - heard < 1e9 * o->patience) {
    unsigned char bytes[HIL_BUFFER];
    struct sockaddr_in from;
    hil_packet p;
    hil_verdict verdict;
    const int n = link_receive(s->link, &from, bytes);
    if (n < 0) {
      if (!link_wait(s->link, 20)) {
        say_hello(s); /* to a plant that has not heard of it, or waits for anybody */
      }
      continue;
    }
    verdict = hil_decode(&p, bytes, n, &s->key);
    verdict = verdict == HIL_ACCEPTED ? take(s, c, &p, &from) : verdict;
    s->traffic.received += verdict == HIL_ACCEPTED;
    s->traffic.refused[verdict] += verdict != HIL_ACCEPTED;
    heard = verdict == HIL_ACCEPTED ? clock_ns() : heard;
    if (verdict == HIL_ACCEPTED && p.time >= o->crash_at) {
      raise(SIGKILL);
    }
  }
}

static void report(session *s, const controller *c)
{
  const hil_traffic *t = &s->traffic;
  printf("hil_controller: notch at %.4f Hz\n", c->swing / 6.283185307179586);
  printf("  packets: %ld sent, %ld unsent, %ld received, %ld lost, %ld refused\n", t->sent, t->unsent, t->received,
         t->lost, hil_refused(t));
  print_refusals(t);
  if (s->samples > 0) {
    const int n = s->samples < MOST_SAMPLES ? (int)s->samples : MOST_SAMPLES;
    const clock_timing time = clock_timing_of(s->computed, n);
    printf("  from sensors to command [us]: min %.1f, median %.1f, p99 %.1f, max %.1f\n", time.lowest, time.median,
           time.p99, time.highest);
    printf("  gauges: right %.3g to %.3g, left %.3g to %.3g\n", s->strain[0][0], s->strain[0][1], s->strain[1][0],
           s->strain[1][1]);
    printf("  estimated bias of the gyros [rad/s]: %.3g %.3g %.3g; attitude from its aim at last [rad]: %.3g\n",
           c->estimate.bias[0], c->estimate.bias[1], c->estimate.bias[2], s->error);
  }
  printf("  %s\n", s->ended           ? "the plant's run has ended"
                   : s->joined        ? "the plant has fallen silent"
                   : has_other_key(s) ? "the plant has another key"
                                      : "no plant has come");
  if (has_other_key(s)) {
    fprintf(stderr, "hil_controller: what answers at port %d has another key: refused (--key, HIL_KEY)\n",
            (int)ntohs(s->plant.sin_port));
  }
}

int main(int argc, char **argv)
{
  static session s;
  static controller c;
  options o = {47800, 30, 1e9, 40, NULL};
  unsigned char number[8];
  int own = 0;
  fb_status status;
  int bad;
  output_begin(PROGRAM);
  bad = read_all(argc, argv, help, read_option, &o);
  if (bad) {
    return bad;
  }
  if (o.port != floor(o.port) || o.priority != floor(o.priority)) {
    return fail("--port and --priority are whole numbers", "");
  }
  if (key_read(&s.key, o.key)) {
    return 2;
  }
  status = controller_init(&c);
  if (status != FB_OK) {
    fprintf(stderr, "hil_controller: %s\n", fb_status_string(status));
    return 1;
  }
  s.link = link_open(&own);
  if (s.link < 0) {
    return fail("cannot have a socket", strerror(errno));
  }
  if (!key_random(number, sizeof number)) {
    return fail("cannot have random numbers", "/dev/urandom");
  }
  s.number = hil_get(number, 8) | 1; /* not 0 */
  s.plant = link_address((int)o.port);
  ask_for_real_time("hil_controller", (int)o.priority);
  fflush(stdout);
  converse(&s, &c, &o);
  report(&s, &c);
  close(s.link);
  return s.ended ? 0 : 1;
}
