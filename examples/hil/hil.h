/* hil.h - the packets between hil_plant and hil_controller: what stands where, writing, reading, what is refused.
   Every number is little-endian, written byte by byte, whatever the host; reals are IEEE-754 doubles.

     byte  size  field
        0     4  magic, "FBHL"
        4     2  version, 2
        6     2  type
        8     4  length of the packet [bytes]
       12     4  sequence number, one more in every packet of a session, which ends before they wrap around
       16     8  sender: the number of the sender's session, drawn at random
       24     8  receiver: that of the receiver's session, 0 in a hello to a plant that has not told it yet
       32     8  time of the plant [s]
       40     4  answers: sequence number of the packet that this one answers
       44   8 n  the type's n values
    44+8n    16  tag: SipHash-2-4 of all bytes before, by the key that both sides share (hil_hash.h)

   Types: 1 hello (controller to plant, no values), 2 sensors (plant to controller), 3 command (controller to plant), 4
   end of the run (plant to controller, no values), 5 challenge (plant to controller, no values).

   A session begins by a hello to receiver 0. The plant answers with a challenge: its sender is a number that the plant
   has drawn for the next session and for no other. The hello to that receiver makes its sender the one that commands,
   and uses the number up. So nothing that was recorded fits another session: it names other numbers.

   WHAT THE TAG IS GOOD FOR. Somebody who can send packets to both ports and read all that are exchanged, but has not
   the key, cannot command the plant, nor deceive the controller: a packet that is made up, changed, shortened, sent
   twice, sent later or kept from another run is refused and counted. What he can do: read (nothing is secret),
   flood a port, or hold packets back; the plant reads a bounded number in a period, and the watchdog ends in the safe
   command. Who has the key is trusted: keep its file unreadable for others (the programs refuse it else). Root, or
   whoever may read this user's files or memory, is beyond what packets can be protected from. */
#ifndef HIL_H
#define HIL_H
#include "hil_hash.h"
#include <math.h>
#include <string.h>

enum { HIL_VERSION = 2, HIL_HEADER = 44, HIL_TRAILER = HIL_TAG };
enum { HIL_HELLO = 1, HIL_SENSORS, HIL_COMMAND, HIL_END, HIL_CHALLENGE, HIL_LAST_TYPE = HIL_CHALLENGE };

enum {                               /* places of the values of a sensor packet */
       HIL_PERIOD = 0,               /* [s] of the plant */
       HIL_SAFE = 1,                 /* 1: the plant acts on its safe command */
       HIL_GYRO = 2,                 /* [rad/s] 3, axes of the hub */
       HIL_FORCE = HIL_GYRO + 3,     /* [m/s^2] 3, accelerometers: specific force, axes of the hub */
       HIL_STAR_NEW = HIL_FORCE + 3, /* 1: the star tracker has a new reading */
       HIL_STAR = HIL_STAR_NEW + 1,  /* 4, its quaternion, hub to inertial axes */
       HIL_WHEEL = HIL_STAR + 4,     /* [rad/s] 3, wheels about x, y, z of the hub, relative to it */
       HIL_DRIVE = HIL_WHEEL + 3,    /* [rad] 2, array drives: right, left */
       HIL_STRAIN = HIL_DRIVE + 2,   /* [-] 2, gauges at the roots of the arrays: right, left */
       HIL_SENSOR_VALUES = HIL_STRAIN + 2
};

enum {                                          /* of a command */
       HIL_WHEEL_TORQUE = 0,                    /* [N m] 3, of the motor on the wheel */
       HIL_DRIVE_TORQUE = HIL_WHEEL_TORQUE + 3, /* [N m] 2, of the motor on the array */
       HIL_COMMAND_VALUES = HIL_DRIVE_TORQUE + 2
};

enum {
  HIL_MOST_VALUES = HIL_SENSOR_VALUES,
  HIL_MOST_BYTES = HIL_HEADER + 8 * HIL_MOST_VALUES + HIL_TRAILER,
  HIL_BUFFER = 2048 /* to receive into: so that what is too long is seen to be */
};

/* A command beyond these is refused, not cut: who sends it has lost its way. */
static const double hil_torque_limit[HIL_COMMAND_VALUES] = {2, 2, 2, 4, 4}; /* [N m] */

/* Why a packet is refused, in the order in which it is looked at. The first six are seen by hil_decode, the others by
   the receiver, who knows what came before. */
#define HIL_REFUSALS(X)                       \
  X(HIL_BAD_LENGTH, "length")                 \
  X(HIL_BAD_MAGIC, "magic")                   \
  X(HIL_BAD_VERSION, "version")               \
  X(HIL_BAD_TYPE, "type")                     \
  X(HIL_BAD_TAG, "not signed by this key")    \
  X(HIL_NOT_FINITE, "not finite")             \
  X(HIL_BAD_SENDER, "wrong sender")           \
  X(HIL_BAD_SESSION, "of another session")    \
  X(HIL_BAD_SEQUENCE, "old or repeated")      \
  X(HIL_BAD_ANSWER, "answers nothing recent") \
  X(HIL_BAD_RANGE, "out of range")

#define HIL_ENUM(name, text) name,
#define HIL_TEXT(name, text) text,
typedef enum hil_verdict { HIL_ACCEPTED, HIL_REFUSALS(HIL_ENUM) HIL_VERDICTS } hil_verdict;

static inline const char *hil_verdict_string(int verdict)
{
  static const char *const text[HIL_VERDICTS] = {"accepted", HIL_REFUSALS(HIL_TEXT)};
  return verdict >= 0 && verdict < HIL_VERDICTS ? text[verdict] : "?";
}

typedef struct hil_packet {
  int type;
  uint32_t sequence, answers;
  uint64_t sender, receiver;
  double time;
  double value[HIL_MOST_VALUES];
} hil_packet;

/* How many values a packet of a type has; -1: there is no such type. */
static inline int hil_values(int type)
{
  static const int values[HIL_LAST_TYPE + 1] = {-1, 0, HIL_SENSOR_VALUES, HIL_COMMAND_VALUES, 0, 0};
  return type >= 0 && type <= HIL_LAST_TYPE ? values[type] : -1;
}

static inline void hil_put_real(unsigned char *to, double x)
{
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  hil_put(to, bits, 8);
}

static inline double hil_get_real(const unsigned char *from)
{
  const uint64_t bits = hil_get(from, 8);
  double x;
  memcpy(&x, &bits, sizeof x);
  return x;
}

/* Sets the tag of n bytes. */
static inline void hil_seal(unsigned char *bytes, int n, const hil_key *key)
{
  hil_hash(bytes + n - HIL_TRAILER, key, bytes, n - HIL_TRAILER);
}

static const unsigned char hil_magic[4] = {'F', 'B', 'H', 'L'};

/* Returns the number of bytes written; 0: no such type. */
static inline int hil_encode(unsigned char bytes[HIL_MOST_BYTES], const hil_packet *p, const hil_key *key)
{
  const int values = hil_values(p->type), n = HIL_HEADER + 8 * values + HIL_TRAILER;
  if (values < 0) {
    return 0;
  }
  memcpy(bytes, hil_magic, 4);
  hil_put(bytes + 4, HIL_VERSION, 2);
  hil_put(bytes + 6, (uint64_t)p->type, 2);
  hil_put(bytes + 8, (uint64_t)n, 4);
  hil_put(bytes + 12, p->sequence, 4);
  hil_put(bytes + 16, p->sender, 8);
  hil_put(bytes + 24, p->receiver, 8);
  hil_put_real(bytes + 32, p->time);
  hil_put(bytes + 40, p->answers, 4);
  for (int i = 0; i < values; i++) {
    hil_put_real(bytes + HIL_HEADER + 8 * i, p->value[i]);
  }
  hil_seal(bytes, n, key);
  return n;
}

/* Reads n bytes; the packet is written only when it is accepted. */
static inline hil_verdict hil_decode(hil_packet *p, const unsigned char *bytes, int n, const hil_key *key)
{
  unsigned char tag[HIL_TAG];
  hil_packet read;
  int values;
  if (n < HIL_HEADER + HIL_TRAILER || n > HIL_MOST_BYTES) {
    return HIL_BAD_LENGTH;
  }
  if (memcmp(bytes, hil_magic, 4) != 0) {
    return HIL_BAD_MAGIC;
  }
  if (hil_get(bytes + 4, 2) != HIL_VERSION) {
    return HIL_BAD_VERSION;
  }
  memset(&read, 0, sizeof read);
  read.type = (int)hil_get(bytes + 6, 2);
  values = hil_values(read.type);
  if (values < 0) {
    return HIL_BAD_TYPE;
  }
  if (n != HIL_HEADER + 8 * values + HIL_TRAILER || hil_get(bytes + 8, 4) != (uint64_t)n) {
    return HIL_BAD_LENGTH;
  }
  hil_hash(tag, key, bytes, n - HIL_TRAILER);
  if (!hil_same_tag(tag, bytes + n - HIL_TRAILER)) {
    return HIL_BAD_TAG;
  }
  read.sequence = (uint32_t)hil_get(bytes + 12, 4);
  read.sender = hil_get(bytes + 16, 8);
  read.receiver = hil_get(bytes + 24, 8);
  read.time = hil_get_real(bytes + 32);
  read.answers = (uint32_t)hil_get(bytes + 40, 4);
  for (int i = 0; i < values; i++) {
    read.value[i] = hil_get_real(bytes + HIL_HEADER + 8 * i);
    if (!isfinite(read.value[i])) {
      return HIL_NOT_FINITE;
    }
  }
  if (!isfinite(read.time)) {
    return HIL_NOT_FINITE;
  }
  *p = read;
  return HIL_ACCEPTED;
}

/* The sender of n bytes that are a hello by their form, whoever has signed it; 0: they are none. */
static inline uint64_t hil_hello_sender(const unsigned char *bytes, int n)
{
  return n == HIL_HEADER + HIL_TRAILER && hil_get(bytes + 6, 2) == HIL_HELLO ? hil_get(bytes + 16, 8) : 0;
}

/* What a receiver of one direction counts. */
typedef struct hil_traffic {
  long sent, unsent;   /* packets; those that the system did not take */
  long received, lost; /* accepted; missing in the other's sequence numbers */
  long refused[HIL_VERDICTS];
} hil_traffic;

static inline long hil_refused(const hil_traffic *t)
{
  long sum = 0;
  for (int k = HIL_ACCEPTED + 1; k < HIL_VERDICTS; k++) {
    sum += t->refused[k];
  }
  return sum;
}
#endif
