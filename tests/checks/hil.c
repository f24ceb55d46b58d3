/* hil - the packets of examples/hil/hil.h: their bytes, their tag by the published vectors, and that nothing else is
   accepted. The key of a plant is that of HIL_KEY. Then, as PORT MODE says,
     hil PORT attack    commands the plant that listens there, sends it each kind of malformed, forged, repeated, late
                        packet before every good one, says how many of which kind the plant has to have refused, and a
                        digest of the sensors; at last it falls silent until the plant says that the safe command acts
     hil PORT alone     the same without the bad ones: the digest must be the same
     hil PORT stranger  says hello without the key and sends commands, full torque, for half a minute or until killed
   Exit: 0 well, 1 something was not as it must be, 2 the plant did not answer. */
#define _POSIX_C_SOURCE 200809L
#define PROGRAM "hil"
#include "../../examples/hil/hil_link.h"
#include "../../examples/common/options.h"
#include "../../examples/hil/hil_key.h"
#include <time.h>

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

static const hil_key some_key = {{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15}};

static hil_packet command_of(uint64_t sender, uint64_t receiver, uint32_t sequence, uint32_t answers)
{
  hil_packet p;
  memset(&p, 0, sizeof p);
  p.type = HIL_COMMAND;
  p.sender = sender;
  p.receiver = receiver;
  p.sequence = sequence;
  p.answers = answers;
  p.time = 1.5;
  for (int i = 0; i < HIL_COMMAND_VALUES; i++) { /* as much as is allowed */
    p.value[i] = sequence % 2 ? hil_torque_limit[i] : -hil_torque_limit[i];
  }
  return p;
}

/* ---- the packets by themselves */

/* J.-P. Aumasson, D. J. Bernstein: reference implementation, vectors.h, SipHash-2-4 with 128 bits: of the bytes 0, 1,
   .. by the key 0, 1, .. 15; none of them, one, two, ... */
static void tags_are_the_published_ones(void)
{
  static const char *const published[] = {
      "a3817f04ba25a8e66df67214c7550293", "da87c1d86b99af44347659119b22fc45", "8177228da4a45dc7fca38bdef60affe4",
      "9c70b60c5267a94e5f33b6b02985ed51", "f88164c12d9c8faf7d0f6e7c7bcd5579", "1368875980776f8854527a07690e9627",
      "14eeca338b208613485ea0308fd7a15e", "a1f1ebbed8dbc153c0b84aa61ff08239", "3b62a9ba6258f5610f83e264f31497b4",
      "264499060ad9baabc47f8b02bb6d71ed", "00110dc378146956c95447d3f3d0fbba", "0151c568386b6677a2b4dc6f81e5dc18",
      "d626b266905ef35882634df68532c125", "9869e247e9c08b10d029934fc4b952f7", "31fcefac66d7de9c7ec7485fe4494902",
      "5493e99933b0a8117e08ec0f97cfc3d9", "6ee2a4ca67b054bbfd3315bf85230577", "473d06e8738db89854c066c47ae47740",
      "a426e5e423bf4885294da481feaef723", "78017731cf65fab074d5208952512eb1", "9e25fc833f2290733e9344a5e83839eb",
      "568e495abe525a218a2214cd3e071d12", "4a29b54552d16b9a469c10528eff0aae", "c9d184ddd5a9f5e0cf8ce29a9abf691c",
      "2db479ae78bd50d8882a8a178a6132ad", "8ece5f042d5e447b5051b9eacb8d8f6f", "9c0b53b4b3c307e87eaee08678141f66",
      "abf248af69a6eae4bfd3eb2f129eeb94", "0664da1668574b88b935f3027358aef4", "aa4b9dc4bf337de90cd4fd3c467c6ab7",
      "ea5c7f471faf6bde2b1ad7d4686d2287", "2939b0183223fafc1723de4f52c43d35", "7c3956ca5eeafc3e363e9d556546eb68",
      "77c6077146f01c32b6b69d5f4ea9ffcf", "37a6986cb8847edf0925f0f1309b54de", "a705f0e69da9a8f907241a2e923c8cc8",
      "3dc47d1f29c448461e9e76ed904f6711", "0d62bf01e6fc0e1a0d3c4751c5d3692b", "8c03468bca7c669ee4fd5e084bbee7b5",
      "528a5bb93baf2c9c4473cce5d0d22bd9", "df6a301e95c95dad97ae0cc8c6913bd8", "801189902c857f39e73591285e70b6db",
      "e617346ac9c231bb3650ae34ccca0c5b", "27d93437efb721aa401821dcec5adf89", "89237d9ded9c5e78d8b1c9b166cc7342",
      "4a6d8091bf5e7d651189fa94a250b14c", "0e33f96055e7ae893ffc0e3dcf492902", "e61c432b720b19d18ec8d84bdc63151b",
      "f7e5aef549f782cf379055a608269b16", "438d030fd0b7a54fa837f2ad201a6403", "a590d3ee4fbf04e3247e0d27f286423f",
      "5fe2c1a172fe93c4b15cd37caef9f538", "2c97325cbd06b36eb2133dd08b3a017c", "92c814227a6bca949ff0659f002ad39e",
      "dce850110bd8328cfbd50841d6911d87", "67f14984c7da791248e32bb5922583da", "1938f2cf72d54ee97e94166fa91d2a36",
      "74481e9646ed49fe0f6224301604698e", "57fca5de98a9d6d8006438d0583d8a1d", "9fecde1cefdc1cbed4763674d9575359",
      "e3040c00eb28f15366ca73cbd872e740", "7697009a6a831dfecca91c5993670f7a", "5853542321f567a005d547a4f04759bd",
      "5150d1772f50834a503e069a973fbd7c"};
  unsigned char bytes[64], tag[HIL_TAG];
  char text[2 * HIL_TAG + 2];
  for (int n = 0; n < 64; n++) {
    hil_hash(tag, &some_key, bytes, n);
    for (int i = 0; i < HIL_TAG; i++) {
      snprintf(text + (ptrdiff_t)2 * i, 3, "%02x", tag[i]);
    }
    claim(strcmp(text, published[n]) == 0, "SipHash-2-4 gives the published tags");
    bytes[n] = (unsigned char)n;
  }
  for (int bit = 0; bit < 8 * HIL_TAG; bit++) {
    unsigned char other[HIL_TAG];
    memcpy(other, tag, sizeof other);
    claim(hil_same_tag(tag, other), "a tag is the same as itself");
    other[bit / 8] ^= (unsigned char)(1u << bit % 8);
    claim(!hil_same_tag(tag, other), "tags that differ in a bit are not the same");
  }
}

static void keys_are_digits(void)
{
  static const char *const wrong[] = {"",
                                      "0",
                                      "000102030405060708090a0b0c0d0e0",
                                      "000102030405060708090a0b0c0d0e0f0",
                                      "000102030405060708090a0b0c0d0e0g",
                                      " 00102030405060708090a0b0c0d0e0f",
                                      "000102030405060708090a0b0c0d0e0f x"};
  hil_key key;
  claim(key_from_text(&key, "000102030405060708090a0B0C0d0e0f\n"), "a key is read");
  claim(memcmp(&key, &some_key, sizeof key) == 0, "as it stands there");
  for (int k = 0; k < (int)(sizeof wrong / sizeof wrong[0]); k++) {
    claim(!key_from_text(&key, wrong[k]), "no other text is a key");
  }
}

static void bytes_are_as_documented(void)
{
  static const unsigned char expected[HIL_HEADER + 8] = {
      'F',  'B',  'H',  'L',  2,    0,    3, 0, 100, 0, 0, 0, 5,    0,    0,  0,  8,  7,  6, 5, 4, 3, 2, 1, 0x18, 0x17,
      0x16, 0x15, 0x14, 0x13, 0x12, 0x11, 0, 0, 0,   0, 0, 0, 0xF8, 0x3F, 13, 12, 11, 10, 0, 0, 0, 0, 0, 0, 0,    0x40};
  const hil_packet p = command_of(0x0102030405060708u, 0x1112131415161718u, 5, 0x0A0B0C0D);
  unsigned char bytes[HIL_MOST_BYTES], tag[HIL_TAG];
  hil_packet back;
  claim(hil_encode(bytes, &p, &some_key) == 100, "a command has 100 bytes");
  claim(memcmp(bytes, expected, sizeof expected) == 0, "little-endian fields at their places");
  hil_hash(tag, &some_key, bytes, 84);
  claim(memcmp(bytes + 84, tag, sizeof tag) == 0, "the tag of all before at the end");
  claim(hil_decode(&back, bytes, 100, &some_key) == HIL_ACCEPTED, "it is accepted");
  claim(back.type == p.type && back.sender == p.sender && back.receiver == p.receiver && back.sequence == 5 &&
            back.answers == p.answers,
        "read back");
  claim(memcmp(back.value, p.value, sizeof p.value) == 0 && memcmp(&back.time, &p.time, 8) == 0, "the same bits");
}

static void everything_else_is_refused(void)
{
  for (int type = HIL_HELLO; type <= HIL_LAST_TYPE; type++) {
    unsigned char bytes[HIL_BUFFER] = {0};
    hil_packet p = command_of(1, 2, 3, 4), unread = p;
    hil_key other_key = some_key;
    int n;
    p.type = type;
    n = hil_encode(bytes, &p, &some_key);
    for (int bit = 0; bit < 8 * n; bit++) {
      bytes[bit / 8] ^= (unsigned char)(1u << bit % 8);
      claim(hil_decode(&p, bytes, n, &some_key) != HIL_ACCEPTED, "a packet with one bit changed is refused");
      bytes[bit / 8] ^= (unsigned char)(1u << bit % 8);
    }
    for (int other = 0; other <= HIL_BUFFER; other++) {
      claim(other == n || hil_decode(&p, bytes, other, &some_key) == HIL_BAD_LENGTH, "any other length is refused");
    }
    for (int bit = 0; bit < 8 * HIL_KEY; bit++) {
      other_key.byte[bit / 8] ^= (unsigned char)(1u << bit % 8);
      claim(hil_decode(&p, bytes, n, &other_key) == HIL_BAD_TAG, "a packet by another key is refused");
      other_key.byte[bit / 8] ^= (unsigned char)(1u << bit % 8);
    }
    p = unread;
    bytes[n - 1] ^= 1;
    claim(hil_decode(&p, bytes, n, &some_key) == HIL_BAD_TAG && memcmp(&p, &unread, sizeof p) == 0,
          "refused: nothing written");
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
    memcpy(bytes, "FBHL\2", (size_t)(n < 6 ? n : 6)); /* or it would not get far */
    claim(hil_decode(&p, bytes, n, &some_key) != HIL_ACCEPTED, "noise is refused");
  }
}

/* ---- the packets against a plant */

typedef struct talk {
  int link, stranger;
  hil_key key, other_key;
  struct sockaddr_in plant;
  uint64_t session;   /* of this side */
  uint32_t sequence;  /* of the last good packet */
  hil_packet sensors; /* the last ones */
  hil_packet earlier; /* a command that was good */
  uint32_t heard;     /* digest of all sensors */
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

static hil_packet good_command(const talk *t)
{
  return command_of(t->session, t->sensors.sender, t->sequence + 1, t->sensors.sequence);
}

/* What hil_decode has to refuse: a good command, then made worse. */
static void spoil_form(talk *t)
{
  const hil_packet good = good_command(t);
  unsigned char bytes[HIL_BUFFER] = {0};
  const int n = hil_encode(bytes, &good, &t->key);
  const double worst[3] = {(double)NAN, HUGE_VAL, -HUGE_VAL};
  unsigned char b[HIL_BUFFER];
#define AGAIN memcpy(b, bytes, sizeof b)
  spoil(t, t->link, HIL_BAD_LENGTH, bytes, chance(n));
  spoil(t, t->link, HIL_BAD_LENGTH, bytes, n + 1 + chance(HIL_BUFFER - n));
  AGAIN;
  hil_put(b + 8, (uint64_t)n + 1 + (uint64_t)chance(1000), 4);
  hil_seal(b, n, &t->key);
  spoil(t, t->link, HIL_BAD_LENGTH, b, n);
  AGAIN;
  b[chance(4)] ^= (unsigned char)(1 + chance(255));
  spoil(t, t->link, HIL_BAD_MAGIC, b, n);
  AGAIN;
  hil_put(b + 4, (uint64_t)HIL_VERSION + 1 + (uint64_t)chance(1000), 2);
  hil_seal(b, n, &t->key);
  spoil(t, t->link, HIL_BAD_VERSION, b, n);
  AGAIN;
  hil_put(b + 6, (uint64_t)HIL_LAST_TYPE + 1 + (uint64_t)chance(1000), 2);
  hil_seal(b, n, &t->key);
  spoil(t, t->link, HIL_BAD_TYPE, b, n);
  AGAIN;
  b[12 + chance(n - 12)] ^= (unsigned char)(1u << chance(8));
  spoil(t, t->link, HIL_BAD_TAG, b, n);
  AGAIN;
  hil_seal(b, n, &t->other_key); /* all of it right but the key */
  spoil(t, t->link, HIL_BAD_TAG, b, n);
  AGAIN;
  hil_put_real(b + HIL_HEADER + 8 * chance(HIL_COMMAND_VALUES), worst[chance(3)]);
  hil_seal(b, n, &t->key);
  spoil(t, t->link, HIL_NOT_FINITE, b, n);
}

static void spoil_packet(talk *t, int link, hil_verdict why, const hil_packet *p)
{
  unsigned char bytes[HIL_MOST_BYTES];
  spoil(t, link, why, bytes, hil_encode(bytes, p, &t->key));
}

/* What only the plant can know to be wrong: well-formed, signed packets at the wrong time, from the wrong place. */
static void spoil_sense(talk *t)
{
  const hil_packet good = good_command(t);
  const int i = chance(HIL_COMMAND_VALUES);
  hil_packet p = t->sensors;
  spoil_packet(t, t->link, HIL_BAD_TYPE, &p); /* the plant's own */
  spoil_packet(t, t->stranger, HIL_BAD_SENDER, &good);
  p = good;
  p.sender++;
  spoil_packet(t, t->link, HIL_BAD_SENDER, &p);
  p.type = HIL_HELLO; /* of another one that has the key, while this one commands */
  p.receiver = 0;
  spoil_packet(t, t->stranger, HIL_BAD_SENDER, &p);
  p = good;
  p.receiver = t->sensors.sender - 1 - (uint64_t)chance(1000); /* kept from another run */
  spoil_packet(t, t->link, HIL_BAD_SESSION, &p);
  p.type = HIL_HELLO;
  spoil_packet(t, t->link, HIL_BAD_SESSION, &p);
  spoil_packet(t, t->link, HIL_BAD_SEQUENCE, &t->earlier); /* once more */
  spoil_packet(t, t->stranger, HIL_BAD_SENDER, &t->earlier);
  p = good;
  p.sequence = t->sequence - (uint32_t)chance(3);
  spoil_packet(t, t->link, HIL_BAD_SEQUENCE, &p);
  p.type = HIL_HELLO;
  spoil_packet(t, t->link, HIL_BAD_SEQUENCE, &p);
  p = good;
  p.answers += 1 + (uint32_t)chance(1000); /* not sent yet */
  spoil_packet(t, t->link, HIL_BAD_ANSWER, &p);
  p.sequence++;
  p.answers = t->sensors.sequence - 100 - (uint32_t)chance(1000); /* the watchdog's time ago */
  spoil_packet(t, t->link, HIL_BAD_ANSWER, &p);
  p = good;
  p.sequence += 3;
  p.value[i] = nextafter(good.value[i], 2 * good.value[i]);
  spoil_packet(t, t->link, HIL_BAD_RANGE, &p);
  p = good;
  p.sequence += 2; /* good, but behind one of a higher number */
  spoil_packet(t, t->link, HIL_BAD_SEQUENCE, &p);
  t->sequence += 4; /* three of these came in their turn: their numbers are used */
}

/* The next packet of that type; one that the plant repeats is passed over. */
static void hear(talk *t, int type, hil_packet *heard)
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
    claim(link_same(&from, &t->plant) && hil_decode(&p, bytes, n, &t->key) == HIL_ACCEPTED,
          "the plant's packets are good");
    claim(p.receiver == t->session, "for this session");
    if (p.type == type && (type != HIL_SENSORS || p.sequence != heard->sequence)) {
      *heard = p;
      return;
    }
  }
}

static void hear_sensors(talk *t)
{
  const hil_packet before = t->sensors;
  hear(t, HIL_SENSORS, &t->sensors);
  claim(t->sensors.sequence == before.sequence + 1 && t->sensors.sender == before.sender, "each in its turn");
  claim(fabs(t->sensors.time - (t->sensors.sequence - 1) * t->sensors.value[HIL_PERIOD]) < 1e-9,
        "with the time of its period");
  for (int i = 0; i < HIL_SENSOR_VALUES; i++) {
    unsigned char bytes[8];
    hil_put_real(bytes, t->sensors.value[i]);
    for (int k = 0; k < 8; k++) {
      t->heard = (t->heard ^ bytes[k]) * 16777619u;
    }
  }
}

static void say_hello(talk *t, uint64_t receiver, uint32_t sequence)
{
  unsigned char bytes[HIL_MOST_BYTES];
  hil_packet hello = command_of(t->session, receiver, sequence, 0);
  hello.type = HIL_HELLO;
  post(t, t->link, bytes, hil_encode(bytes, &hello, &t->key));
}

static void begin_talk(talk *t, int port)
{
  int own = 0, other = 0;
  unsigned char number[8];
  memset(t, 0, sizeof *t);
  claim(key_read(&t->key, NULL) == 0, "HIL_KEY is a key");
  t->other_key = t->key;
  t->other_key.byte[HIL_KEY - 1] ^= 1;
  t->link = link_open(&own);
  t->stranger = link_open(&other);
  claim(t->link >= 0 && t->stranger >= 0, "there are sockets");
  t->plant = link_address(port);
  claim(key_random(number, sizeof number), "there are random numbers");
  t->session = hil_get(number, 8);
}

static void command_plant(int port, int attack)
{
  static talk t;
  unsigned char bytes[HIL_MOST_BYTES];
  hil_packet challenge, p;
  begin_talk(&t, port);
  t.sequence = 0x7FFFFFFDu; /* ascends through all bits */
  say_hello(&t, 0, t.sequence);
  memset(&challenge, 0, sizeof challenge);
  hear(&t, HIL_CHALLENGE, &challenge);
  if (attack) { /* it was kept from a run before: none of these begins a session */
    say_hello(&t, challenge.sender + 1, t.sequence);
    t.expected.refused[HIL_BAD_SESSION]++;
    p = command_of(t.session, challenge.sender, t.sequence + 1, 0);
    spoil_packet(&t, t.link, HIL_BAD_SENDER, &p);
  }
  say_hello(&t, challenge.sender, ++t.sequence);
  t.sensors.sender = challenge.sender;
  for (int k = 0; k < ROUNDS; k++) {
    hear_sensors(&t);
    if (k > 0) {
      claim(t.sensors.value[HIL_SAFE] == 0, "a good packet among bad ones commands");
    }
    if (k > 0 && attack) {
      spoil_form(&t);
      spoil_sense(&t);
    }
    p = command_of(t.session, t.sensors.sender, ++t.sequence, t.sensors.sequence);
    for (int i = 0; i < HIL_COMMAND_VALUES; i++) { /* the same torques, whatever its sequence number */
      p.value[i] = k % 2 ? hil_torque_limit[i] : -hil_torque_limit[i];
    }
    post(&t, t.link, bytes, hil_encode(bytes, &p, &t.key));
    t.earlier = p;
  }
  hear_sensors(&t);
  if (attack) {
    print_refusals(&t.expected);
  }
  printf("sensors %08lx\n", (unsigned long)t.heard);
  while (t.sensors.value[HIL_SAFE] == 0) {
    hear_sensors(&t);
  }
}

/* Without the key: it says hello to all that it is told, and commands, at each millisecond. */
static void be_a_stranger(int port)
{
  static talk t;
  hil_packet hello, p;
  begin_talk(&t, port);
  hello = command_of(t.session, 0, 0, 0);
  hello.type = HIL_HELLO;
  for (int k = 0; k < 30000; k++) {
    const struct timespec pause = {0, 1000000};
    unsigned char bytes[HIL_BUFFER];
    struct sockaddr_in from;
    while (link_receive(t.link, &from, bytes) >= 0) {
      hello.receiver = hil_get(bytes + 16, 8); /* what a challenge tells can be read without a key */
    }
    hello.sequence++;
    post(&t, t.link, bytes, hil_encode(bytes, &hello, &t.other_key));
    p = command_of(t.session, hello.receiver, ++hello.sequence, (uint32_t)k);
    post(&t, t.link, bytes, hil_encode(bytes, &p, &t.other_key));
    nanosleep(&pause, NULL);
  }
}

int main(int argc, char **argv)
{
  const int port = argc > 2 ? (int)strtol(argv[1], NULL, 10) : 0;
  tags_are_the_published_ones();
  keys_are_digits();
  bytes_are_as_documented();
  everything_else_is_refused();
  noise_is_refused();
  if (argc > 2 && strcmp(argv[2], "stranger") == 0) {
    be_a_stranger(port);
  } else if (argc > 2) {
    command_plant(port, strcmp(argv[2], "attack") == 0);
  }
  return 0;
}
