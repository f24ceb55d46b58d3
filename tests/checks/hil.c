/* hil - the packets of examples/hil.h: their bytes, and that nothing else is accepted. With a port it then commands the
   plant that listens there, sends it each kind of malformed packet before every good one, and says how many of which
   kind the plant has to have refused; at last it falls silent until the plant says that the safe command acts.
   Exit: 0 well, 1 something was not as it must be, 2 the plant did not answer. */
#define _POSIX_C_SOURCE 200809L
#include "../../examples/hil_link.h"
#include <stdlib.h>

enum { ROUNDS = 300 };

static uint32_t seed = 1;

/* 0 .. n - 1, repeatable */
static int chance(int n)
{
  seed = seed * 1664525u + 1013904223u;
  return (int)((seed >> 8) % (uint32_t)n);
}

static void claim(int holds, const char *what)
{
  if (!holds) {
    fprintf(stderr, "hil: not so: %s\n", what);
    exit(1);
  }
}

static hil_packet command_of(uint32_t session, uint32_t sequence, uint32_t answers)
{
  hil_packet p;
  memset(&p, 0, sizeof p);
  p.type = HIL_COMMAND;
  p.session = session;
  p.sequence = sequence;
  p.answers = answers;
  p.time = 1.5;
  for (int i = 0; i < HIL_COMMAND_VALUES; i++) { /* as much as is allowed */
    p.value[i] = sequence % 2 ? hil_torque_limit[i] : -hil_torque_limit[i];
  }
  return p;
}

/* ---- the packets by themselves */

static void bytes_are_as_documented(void)
{
  static const unsigned char expected[HIL_HEADER + 8] = {'F', 'B', 'H',  'L',  1, 0, 3,  0,  76, 0,  0, 0,   4, 3,
                                                         2,   1,   5,    0,    0, 0, 13, 12, 11, 10, 0, 0,   0, 0,
                                                         0,   0,   0xF8, 0x3F, 0, 0, 0,  0,  0,  0,  0, 0x40};
  const hil_packet p = command_of(0x01020304, 5, 0x0A0B0C0D);
  unsigned char bytes[HIL_MOST_BYTES];
  hil_packet back;
  claim(hil_crc((const unsigned char *)"123456789", 9) == 0xCBF43926u, "the check word is CRC-32's");
  claim(hil_encode(bytes, &p) == 76, "a command has 76 bytes");
  claim(memcmp(bytes, expected, sizeof expected) == 0, "little-endian fields at their places");
  claim(hil_decode(&back, bytes, 76) == HIL_ACCEPTED, "it is accepted");
  claim(back.type == p.type && back.session == p.session && back.sequence == 5 && back.answers == p.answers,
        "read back");
  claim(memcmp(back.value, p.value, sizeof p.value) == 0 && memcmp(&back.time, &p.time, 8) == 0, "the same bits");
}

static void everything_else_is_refused(void)
{
  for (int type = HIL_HELLO; type <= HIL_LAST_TYPE; type++) {
    unsigned char bytes[HIL_BUFFER] = {0};
    hil_packet p = command_of(1, 2, 3), unread = p;
    int n;
    p.type = type;
    n = hil_encode(bytes, &p);
    for (int bit = 0; bit < 8 * n; bit++) {
      bytes[bit / 8] ^= (unsigned char)(1u << bit % 8);
      claim(hil_decode(&p, bytes, n) != HIL_ACCEPTED, "a packet with one bit changed is refused");
      bytes[bit / 8] ^= (unsigned char)(1u << bit % 8);
    }
    for (int other = 0; other <= HIL_BUFFER; other++) {
      claim(other == n || hil_decode(&p, bytes, other) == HIL_BAD_LENGTH, "any other length is refused");
    }
    p = unread;
    bytes[n - 1] ^= 1;
    claim(hil_decode(&p, bytes, n) == HIL_BAD_CHECK && memcmp(&p, &unread, sizeof p) == 0, "refused: nothing written");
  }
}

static void noise_is_refused(void)
{
  unsigned char bytes[HIL_MOST_BYTES];
  hil_packet p;
  for (int k = 0; k < 200000; k++) {
    const int n = chance(HIL_MOST_BYTES + 1);
    for (int i = 0; i < n; i++) {
      bytes[i] = (unsigned char)chance(256);
    }
    memcpy(bytes, "FBHL\1", (size_t)(n < 6 ? n : 6)); /* or it would not get far */
    claim(hil_decode(&p, bytes, n) != HIL_ACCEPTED, "noise is refused");
  }
}

static void sequence_numbers_wrap(void)
{
  claim(hil_after(1, 0) && hil_after(0, 0xFFFFFFFFu) && hil_after(5, 0xFFFFFFF0u), "later numbers come after");
  claim(!hil_after(7, 7) && !hil_after(0, 1) && !hil_after(0xFFFFFFFFu, 0), "the same and earlier ones do not");
}

/* ---- the packets against a plant */

typedef struct talk {
  int link, stranger;
  struct sockaddr_in plant;
  uint32_t session, sequence; /* of the last good packet */
  hil_packet sensors;         /* the last ones */
  hil_traffic expected;
} talk;

static void post(talk *t, int link, const unsigned char *bytes, int n)
{
  claim(link_send(link, &t->plant, bytes, n), "the system takes the packet");
}

static void spoil(talk *t, int link, hil_verdict why, const unsigned char *bytes, int n)
{
  post(t, link, bytes, n);
  t->expected.refused[why]++;
}

/* What hil_decode has to refuse: a good command, then made worse. */
static void spoil_form(talk *t)
{
  const hil_packet good = command_of(t->session, t->sequence + 1, t->sensors.sequence);
  unsigned char bytes[HIL_BUFFER] = {0};
  const int n = hil_encode(bytes, &good);
  const double worst[3] = {(double)NAN, HUGE_VAL, -HUGE_VAL};
  unsigned char b[HIL_BUFFER];
#define AGAIN memcpy(b, bytes, sizeof b)
  spoil(t, t->link, HIL_BAD_LENGTH, bytes, chance(n));
  spoil(t, t->link, HIL_BAD_LENGTH, bytes, n + 1 + chance(HIL_BUFFER - n));
  AGAIN;
  hil_put(b + 8, (uint64_t)n + 1 + (uint64_t)chance(1000), 4);
  hil_seal(b, n);
  spoil(t, t->link, HIL_BAD_LENGTH, b, n);
  AGAIN;
  b[chance(4)] ^= (unsigned char)(1 + chance(255));
  spoil(t, t->link, HIL_BAD_MAGIC, b, n);
  AGAIN;
  hil_put(b + 4, (uint64_t)HIL_VERSION + 1 + (uint64_t)chance(1000), 2);
  hil_seal(b, n);
  spoil(t, t->link, HIL_BAD_VERSION, b, n);
  AGAIN;
  hil_put(b + 6, (uint64_t)HIL_LAST_TYPE + 1 + (uint64_t)chance(1000), 2);
  hil_seal(b, n);
  spoil(t, t->link, HIL_BAD_TYPE, b, n);
  AGAIN;
  b[12 + chance(n - 12)] ^= (unsigned char)(1u << chance(8));
  spoil(t, t->link, HIL_BAD_CHECK, b, n);
  AGAIN;
  hil_put_real(b + HIL_HEADER + 8 * chance(HIL_COMMAND_VALUES), worst[chance(3)]);
  hil_seal(b, n);
  spoil(t, t->link, HIL_NOT_FINITE, b, n);
}

static void spoil_packet(talk *t, int link, hil_verdict why, const hil_packet *p)
{
  unsigned char bytes[HIL_MOST_BYTES];
  spoil(t, link, why, bytes, hil_encode(bytes, p));
}

/* What only the plant can know to be wrong: well-formed packets at the wrong time, from the wrong place. */
static void spoil_sense(talk *t)
{
  const hil_packet good = command_of(t->session, t->sequence + 1, t->sensors.sequence);
  const int i = chance(HIL_COMMAND_VALUES);
  hil_packet p = t->sensors;
  spoil_packet(t, t->link, HIL_BAD_TYPE, &p); /* the plant's own */
  spoil_packet(t, t->stranger, HIL_BAD_SENDER, &good);
  p = good;
  p.session++;
  spoil_packet(t, t->link, HIL_BAD_SENDER, &p);
  p = good;
  p.type = HIL_HELLO;
  spoil_packet(t, t->stranger, HIL_BAD_SENDER, &p);
  p = good;
  p.sequence = t->sequence - (uint32_t)chance(3);
  spoil_packet(t, t->link, HIL_BAD_SEQUENCE, &p);
  p = good;
  p.answers += 1 + (uint32_t)chance(1000); /* not sent yet */
  spoil_packet(t, t->link, HIL_BAD_ANSWER, &p);
  p.sequence++;
  p.answers = t->sensors.sequence - 100 - (uint32_t)chance(1000); /* the watchdog's time ago */
  spoil_packet(t, t->link, HIL_BAD_ANSWER, &p);
  p = good;
  p.sequence += 2;
  p.value[i] = nextafter(good.value[i], 2 * good.value[i]);
  spoil_packet(t, t->link, HIL_BAD_RANGE, &p);
  t->sequence = p.sequence; /* the last three came in their turn: their numbers are used */
}

/* The next sensors; a packet that the plant repeats is passed over. */
static void hear(talk *t)
{
  for (;;) {
    unsigned char bytes[HIL_BUFFER];
    struct sockaddr_in from;
    hil_packet p;
    const int n = link_receive(t->link, &from, bytes);
    if (n < 0) {
      if (!link_wait(t->link, 20000)) {
        fprintf(stderr, "hil: the plant does not answer\n");
        exit(2);
      }
      continue;
    }
    claim(link_same(&from, &t->plant) && hil_decode(&p, bytes, n) == HIL_ACCEPTED, "the plant's packets are good");
    claim(p.type == HIL_SENSORS, "it sends sensors");
    if (p.sequence != t->sensors.sequence) {
      claim(p.sequence == t->sensors.sequence + 1, "each in its turn");
      claim(fabs(p.time - (p.sequence - 1) * p.value[HIL_PERIOD]) < 1e-9, "with the time of its period");
      t->sensors = p;
      return;
    }
  }
}

static void command_plant(int port)
{
  static talk t;
  unsigned char bytes[HIL_MOST_BYTES];
  hil_packet hello;
  int own = 0, other = 0;
  t.link = link_open(&own);
  t.stranger = link_open(&other);
  claim(t.link >= 0 && t.stranger >= 0, "there are sockets");
  t.plant = link_address(port);
  t.session = 12345;
  t.sequence = 0xFFFFFFF0u; /* wraps on the way */
  hello = command_of(t.session, t.sequence, 0);
  hello.type = HIL_HELLO;
  post(&t, t.link, bytes, hil_encode(bytes, &hello));
  for (int k = 0; k < ROUNDS; k++) {
    hil_packet good;
    hear(&t);
    if (k > 0) {
      claim(t.sensors.value[HIL_SAFE] == 0, "a good packet among bad ones commands");
      spoil_form(&t);
      spoil_sense(&t);
    }
    good = command_of(t.session, ++t.sequence, t.sensors.sequence);
    post(&t, t.link, bytes, hil_encode(bytes, &good));
  }
  do {
    hear(&t);
  } while (t.sensors.value[HIL_SAFE] == 0);
  print_refusals(&t.expected);
}

int main(int argc, char **argv)
{
  bytes_are_as_documented();
  everything_else_is_refused();
  noise_is_refused();
  sequence_numbers_wrap();
  if (argc > 1) {
    command_plant((int)strtol(argv[1], NULL, 10));
  }
  return 0;
}
