/* hil.h - the packets between hil_plant and hil_controller: what stands where, writing, reading, what is refused.
   Every number is little-endian, written byte by byte, whatever the host; reals are IEEE-754 doubles.

     byte  size  field
        0     4  magic, "FBHL"
        4     2  version, 1
        6     2  type
        8     4  length of the packet [bytes]
       12     4  session: the sender's own number, another one each time it starts
       16     4  sequence number, one more in every packet of a session; wraps around
       20     4  answers: sequence number of the packet that this one answers
       24     8  time of the plant [s]
       32   8 n  the type's n values
    32+8n     4  check word: CRC-32 (IEEE 802.3) of all bytes before

   Types: 1 hello (controller to plant, no values), 2 sensors (plant to controller), 3 command (controller to plant), 4
   end of the run (plant to controller, no values). */
#ifndef HIL_H
#define HIL_H
#include <math.h>
#include <stdint.h>
#include <string.h>

enum { HIL_VERSION = 1, HIL_HEADER = 32, HIL_TRAILER = 4 };
enum { HIL_HELLO = 1, HIL_SENSORS = 2, HIL_COMMAND = 3, HIL_END = 4, HIL_LAST_TYPE = HIL_END };

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

/* Why a packet is refused, in the order in which it is looked at. The first six and the finite numbers are seen by
   hil_decode, the others by the receiver, who knows what came before. */
#define HIL_REFUSALS(X)                       \
  X(HIL_BAD_LENGTH, "length")                 \
  X(HIL_BAD_MAGIC, "magic")                   \
  X(HIL_BAD_VERSION, "version")               \
  X(HIL_BAD_TYPE, "type")                     \
  X(HIL_BAD_CHECK, "check word")              \
  X(HIL_NOT_FINITE, "not finite")             \
  X(HIL_BAD_SENDER, "wrong sender")           \
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
  uint32_t session, sequence, answers;
  double time;
  double value[HIL_MOST_VALUES];
} hil_packet;

/* How many values a packet of a type has; -1: there is no such type. */
static inline int hil_values(int type)
{
  static const int values[HIL_LAST_TYPE + 1] = {-1, 0, HIL_SENSOR_VALUES, HIL_COMMAND_VALUES, 0};
  return type >= 0 && type <= HIL_LAST_TYPE ? values[type] : -1;
}

/* 1 if sequence number a comes after b: less than half the way around. */
static inline int hil_after(uint32_t a, uint32_t b)
{
  return a != b && (uint32_t)(a - b) < 0x80000000u;
}

static inline void hil_put(unsigned char *to, uint64_t x, int bytes)
{
  for (int i = 0; i < bytes; i++) {
    to[i] = (unsigned char)(x >> (8 * i) & 255u);
  }
}

static inline uint64_t hil_get(const unsigned char *from, int bytes)
{
  uint64_t x = 0;
  for (int i = 0; i < bytes; i++) {
    x |= (uint64_t)from[i] << (8 * i);
  }
  return x;
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

/* CRC-32 of IEEE 802.3: polynomial 0x04C11DB7, bits reflected, begins and ends with all ones. */
static inline uint32_t hil_crc(const unsigned char *bytes, int n)
{
  uint32_t crc = 0xFFFFFFFFu;
  for (int i = 0; i < n; i++) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; bit++) {
      crc = crc >> 1 ^ (crc & 1u ? 0xEDB88320u : 0u);
    }
  }
  return ~crc;
}

/* Sets the check word of n bytes. */
static inline void hil_seal(unsigned char *bytes, int n)
{
  hil_put(bytes + n - HIL_TRAILER, hil_crc(bytes, n - HIL_TRAILER), 4);
}

static const unsigned char hil_magic[4] = {'F', 'B', 'H', 'L'};

/* Returns the number of bytes written; 0: no such type. */
static inline int hil_encode(unsigned char bytes[HIL_MOST_BYTES], const hil_packet *p)
{
  const int values = hil_values(p->type), n = HIL_HEADER + 8 * values + HIL_TRAILER;
  if (values < 0) {
    return 0;
  }
  memcpy(bytes, hil_magic, 4);
  hil_put(bytes + 4, HIL_VERSION, 2);
  hil_put(bytes + 6, (uint64_t)p->type, 2);
  hil_put(bytes + 8, (uint64_t)n, 4);
  hil_put(bytes + 12, p->session, 4);
  hil_put(bytes + 16, p->sequence, 4);
  hil_put(bytes + 20, p->answers, 4);
  hil_put_real(bytes + 24, p->time);
  for (int i = 0; i < values; i++) {
    hil_put_real(bytes + HIL_HEADER + 8 * i, p->value[i]);
  }
  hil_seal(bytes, n);
  return n;
}

/* Reads n bytes; the packet is written only when it is accepted. */
static inline hil_verdict hil_decode(hil_packet *p, const unsigned char *bytes, int n)
{
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
  if (hil_get(bytes + n - HIL_TRAILER, 4) != hil_crc(bytes, n - HIL_TRAILER)) {
    return HIL_BAD_CHECK;
  }
  read.session = (uint32_t)hil_get(bytes + 12, 4);
  read.sequence = (uint32_t)hil_get(bytes + 16, 4);
  read.answers = (uint32_t)hil_get(bytes + 20, 4);
  read.time = hil_get_real(bytes + 24);
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
