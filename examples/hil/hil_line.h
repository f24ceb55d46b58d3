/* hil_line.h - the plant's end of the line: who commands, what is refused and why, the watchdog, lock-step. Include
   ../examples/common/clock.h and hil_link.h before, and define PROGRAM. What is guarded against, and what not:
   hil.h. */
#ifndef HIL_LINE_H
#define HIL_LINE_H
#include <signal.h>

enum { REAL_TIME, LOCK_STEP, DIRECT }; /* who says when a period begins: the clock, the answer, nobody */
enum { MOST_EVENTS = 20, PACKETS_A_PERIOD = 64, PARTNER_PATIENCE = 30 }; /* -, -, [s] */

typedef struct event {
  double time; /* [s] */
  const char *what;
} event;

typedef struct line {
  int link;
  hil_key key, seed;
  long most_silent; /* periods without a command that are borne */
  hil_traffic traffic;
  uint64_t session, challenge, numbers; /* this session's number, the next one's; numbers drawn */
  uint32_t sequence;                    /* of the packets sent */
  hil_packet packet;                    /* the last sensors */
  int partner;                          /* 1: there is one */
  struct sockaddr_in at;
  uint64_t partner_session;
  uint32_t partner_sequence; /* of the last packet from there */
  int stranger, told;        /* hellos not signed by the key; that was said */
  uint32_t answered;         /* the packet that the command answers */
  double command[HIL_COMMAND_VALUES];
  int fresh;   /* it has come since the last period */
  long silent; /* periods since */
  int safe;    /* the safe command acts */
  int gone;    /* lock-step: the partner is waited for no more */
  long trips, recoveries;
  event events[MOST_EVENTS];
  int n_event; /* all of them, of which the first MOST_EVENTS are kept */
} line;

static void note(line *l, double time, const char *what)
{
  if (l->n_event < MOST_EVENTS) {
    l->events[l->n_event].time = time;
    l->events[l->n_event].what = what;
  }
  l->n_event++;
}

/* A number for a session, unlike all before and not to be guessed: no file is read for it in the run. */
static uint64_t draw_number(line *l)
{
  unsigned char count[8], tag[HIL_TAG];
  uint64_t number;
  do {
    hil_put(count, ++l->numbers, 8);
    hil_hash(tag, &l->seed, count, 8);
    number = hil_get(tag, 8);
  } while (number == 0);
  return number;
}

static void line_init(line *l, int link, const hil_key *key, const hil_key *seed, long most_silent)
{
  memset(l, 0, sizeof *l);
  l->link = link;
  l->key = *key;
  l->seed = *seed;
  l->challenge = draw_number(l);
  l->most_silent = most_silent;
  l->safe = 1;
}

/* Signed, so that who has another key sees it. */
static void send_challenge(line *l, uint64_t to, const struct sockaddr_in *at)
{
  unsigned char bytes[HIL_MOST_BYTES];
  hil_packet p;
  int sent;
  memset(&p, 0, sizeof p);
  p.type = HIL_CHALLENGE;
  p.sender = l->challenge;
  p.receiver = to;
  sent = link_send(l->link, at, bytes, hil_encode(bytes, &p, &l->key));
  l->traffic.sent += sent;
  l->traffic.unsent += !sent;
}

/* A hello to the number that was drawn for the next session makes a partner of its sender; one to no number gets to
   know that number; unless another one commands. */
static hil_verdict take_hello(line *l, const hil_packet *p, const struct sockaddr_in *from)
{
  const int known = l->partner && link_same(from, &l->at) && p->sender == l->partner_session;
  if (!known && l->partner && !l->safe) {
    return HIL_BAD_SENDER;
  }
  if (known && p->sequence <= l->partner_sequence) {
    return HIL_BAD_SEQUENCE;
  }
  if (p->receiver == 0 && !known) {
    send_challenge(l, p->sender, from);
    return HIL_ACCEPTED;
  }
  if (p->receiver != (known ? l->session : l->challenge)) {
    return HIL_BAD_SESSION;
  }
  if (!known) {
    l->session = l->challenge;
    l->challenge = draw_number(l);
    l->partner = 1;
    l->at = *from;
    l->partner_session = p->sender;
  }
  l->gone = 0;
  l->partner_sequence = p->sequence;
  return HIL_ACCEPTED;
}

static hil_verdict take_command(line *l, const hil_packet *p, const struct sockaddr_in *from)
{
  if (!l->partner || !link_same(from, &l->at) || p->sender != l->partner_session) {
    return HIL_BAD_SENDER;
  }
  if (p->receiver != l->session) {
    return HIL_BAD_SESSION;
  }
  if (p->sequence <= l->partner_sequence) {
    return HIL_BAD_SEQUENCE;
  }
  l->traffic.lost += (long)(uint32_t)(p->sequence - l->partner_sequence - 1);
  l->partner_sequence = p->sequence;
  if ((uint32_t)(l->sequence - p->answers) >= (uint32_t)l->most_silent) {
    return HIL_BAD_ANSWER;
  }
  for (int i = 0; i < HIL_COMMAND_VALUES; i++) {
    if (fabs(p->value[i]) > hil_torque_limit[i]) {
      return HIL_BAD_RANGE;
    }
  }
  l->answered = p->answers;
  l->fresh = 1;
  l->gone = 0;
  memcpy(l->command, p->value, sizeof l->command);
  return HIL_ACCEPTED;
}

/* A hello by another key is told so, by a challenge that its sender cannot check: one at a time, so that this is no way
   to take the plant's time. */
static void answer_stranger(line *l, const struct sockaddr_in *from, const unsigned char *bytes, int n, int *answered)
{
  const uint64_t sender = hil_hello_sender(bytes, n);
  l->stranger += sender != 0;
  if (sender != 0 && !*answered) {
    send_challenge(l, sender, from);
    *answered = 1;
  }
}

/* Reads what has come, in a period at most so much that a flood does not take its time. */
static void receive(line *l)
{
  unsigned char bytes[HIL_BUFFER];
  struct sockaddr_in from;
  int answered = 0;
  for (int k = 0; k < PACKETS_A_PERIOD; k++) {
    hil_packet p;
    hil_verdict verdict;
    const int n = link_receive(l->link, &from, bytes);
    if (n < 0) {
      return;
    }
    verdict = from.sin_addr.s_addr != htonl(INADDR_LOOPBACK) ? HIL_BAD_SENDER : hil_decode(&p, bytes, n, &l->key);
    if (verdict == HIL_ACCEPTED) {
      verdict = p.type == HIL_HELLO     ? take_hello(l, &p, &from)
                : p.type == HIL_COMMAND ? take_command(l, &p, &from)
                                        : HIL_BAD_TYPE;
    } else if (verdict == HIL_BAD_TAG) {
      answer_stranger(l, &from, bytes, n, &answered);
    }
    l->traffic.received += verdict == HIL_ACCEPTED;
    l->traffic.refused[verdict] += verdict != HIL_ACCEPTED;
  }
}

/* The last packet, in the session that there is now. */
static void send_again(line *l)
{
  unsigned char bytes[HIL_MOST_BYTES];
  int sent;
  l->packet.sender = l->session;
  l->packet.receiver = l->partner_session;
  l->packet.answers = l->partner_sequence;
  sent = l->partner && link_send(l->link, &l->at, bytes, hil_encode(bytes, &l->packet, &l->key));
  l->traffic.sent += sent;
  l->traffic.unsent += l->partner && !sent;
}

static void send_packet(line *l, int type, double time, const double *values)
{
  hil_packet *const p = &l->packet;
  memset(p, 0, sizeof *p);
  p->type = type;
  p->sequence = ++l->sequence;
  p->time = time;
  memcpy(p->value, values, (size_t)hil_values(type) * sizeof p->value[0]);
  send_again(l);
}

/* Once a period: does a command act, or the safe one? */
static void watch(line *l, double time)
{
  l->silent = l->fresh ? 0 : l->silent + 1;
  if (l->fresh && l->safe) {
    l->recoveries += l->trips > 0;
    note(l, time, l->trips > 0 ? "commanded again" : "commanded");
    l->safe = 0;
  } else if (!l->safe && l->silent >= l->most_silent) {
    l->trips++;
    note(l, time, "watchdog: safe command");
    l->safe = 1;
  }
  l->fresh = 0;
}

static volatile sig_atomic_t interrupted;

/* 1 when a hello or a command has come; half a minute at most. What was sent last is sent again: it may be what the
   partner waits for. */
static int await_partner(line *l)
{
  const double give_up = clock_ns() + 1e9 * PARTNER_PATIENCE;
  const int known = l->partner;
  while (!interrupted && clock_ns() < give_up) {
    receive(l);
    if (known ? !l->gone : l->partner) {
      return 1;
    }
    if (l->stranger > 0 && !l->told++) {
      fprintf(stderr, PROGRAM ": somebody says hello who has another key: refused (--key, HIL_KEY)\n");
    }
    if (!link_wait(l->link, 100) && l->packet.type > 0) {
      send_again(l);
    }
  }
  return 0;
}

/* Lock-step: the answer to the last packet, for `patience` seconds. A partner that has fallen silent is not waited for
   while the watchdog counts and the safe command then acts as long again; after that one must come. 0: none came. */
static int await_answer(line *l, double patience)
{
  const double give_up = clock_ns() + 1e9 * patience;
  receive(l);
  if (l->gone) {
    return l->silent < 2 * l->most_silent || await_partner(l);
  }
  while (!interrupted && l->answered != l->sequence) {
    if (clock_ns() > give_up) {
      l->gone = 1;
      break;
    }
    if (!link_wait(l->link, 200)) {
      send_again(l);
    }
    receive(l);
  }
  return 1;
}
#endif
