/* hil_link.h - what hil_plant and hil_controller want of a POSIX system: UDP sockets on the loopback address alone, and
   a process that is scheduled first and keeps its memory. Define _POSIX_C_SOURCE 200809L. */
#ifndef HIL_LINK_H
#define HIL_LINK_H
#include "hil.h"
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sched.h>
#include <stdio.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

/* 127.0.0.1 */
static inline struct sockaddr_in link_address(int port)
{
  struct sockaddr_in a;
  memset(&a, 0, sizeof a);
  a.sin_family = AF_INET;
  a.sin_port = htons((uint16_t)port);
  a.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return a;
}

static inline int link_same(const struct sockaddr_in *a, const struct sockaddr_in *b)
{
  return a->sin_addr.s_addr == b->sin_addr.s_addr && a->sin_port == b->sin_port;
}

/* A socket that receives on a port of 127.0.0.1 (0: the system chooses; *port says which) and never waits. Negative:
   errno tells why there is none. */
static inline int link_open(int *port)
{
  struct sockaddr_in at = link_address(*port);
  socklen_t size = sizeof at;
  const int link = socket(AF_INET, SOCK_DGRAM, 0);
  if (link < 0) {
    return link;
  }
  if (bind(link, (const struct sockaddr *)&at, sizeof at) != 0 || fcntl(link, F_SETFL, O_NONBLOCK) != 0 ||
      getsockname(link, (struct sockaddr *)&at, &size) != 0) {
    const int error = errno;
    close(link);
    errno = error;
    return -1;
  }
  *port = ntohs(at.sin_port);
  return link;
}

/* 1 if the system took all bytes. */
static inline int link_send(int link, const struct sockaddr_in *to, const unsigned char *bytes, int n)
{
  return sendto(link, bytes, (size_t)n, 0, (const struct sockaddr *)to, sizeof *to) == n;
}

/* Number of bytes of the next packet and its sender; negative: none is there. */
static inline int link_receive(int link, struct sockaddr_in *from, unsigned char bytes[HIL_BUFFER])
{
  for (int k = 0; k < 16; k++) {
    socklen_t size = sizeof *from;
    const ssize_t n = recvfrom(link, bytes, HIL_BUFFER, 0, (struct sockaddr *)from, &size);
    if (n >= 0) {
      return (int)n;
    }
    if (errno != EINTR && errno != ECONNREFUSED) { /* the latter: an earlier packet found no receiver */
      break;
    }
  }
  return -1;
}

/* Waits until something can be received: 1; or for that time: 0. */
static inline int link_wait(int link, int milliseconds)
{
  struct pollfd waiting;
  waiting.fd = link;
  waiting.events = POLLIN;
  waiting.revents = 0;
  return poll(&waiting, 1, milliseconds) > 0;
}

/* Asks for the scheduler's first class and for memory that stays; says what was refused. */
static inline void ask_for_real_time(const char *program, int priority)
{
  struct sched_param wanted;
  memset(&wanted, 0, sizeof wanted);
  wanted.sched_priority = priority;
  if (priority <= 0) {
    printf("%s: scheduled as any other program\n", program);
    return;
  }
  if (sched_setscheduler(0, SCHED_FIFO, &wanted) == 0) {
    printf("%s: SCHED_FIFO, priority %d", program, priority);
  } else {
    printf("%s: SCHED_FIFO refused (%s)", program, strerror(errno));
  }
  if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) {
    printf(", memory locked\n");
  } else {
    printf(", mlockall refused (%s)\n", strerror(errno));
  }
}

/* Back to where other programs are, and those that it starts. */
static inline void leave_real_time(void)
{
  struct sched_param none;
  memset(&none, 0, sizeof none);
  (void)sched_setscheduler(0, SCHED_OTHER, &none);
  (void)munlockall();
}

static inline void print_refusals(const hil_traffic *t)
{
  for (int k = HIL_ACCEPTED + 1; k < HIL_VERDICTS; k++) {
    printf("  refused, %-24s %8ld\n", hil_verdict_string(k), t->refused[k]);
  }
}
#endif
