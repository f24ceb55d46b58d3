/* campaign_case.h - the runs of a campaign, in worker processes: a worker that dies by a run that crashes or does not
   end makes a row like any other, and gets a successor. POSIX (fork, pipe, waitpid, setitimer). Not a process for each
   run: that would cost the pages of the scene each time. */
#ifndef CAMPAIGN_CASE_H
#define CAMPAIGN_CASE_H
#include "../scene/scene_run.h"
#include "campaign.h"
#include "../common/same_file.h"
#include <signal.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#define CAMPAIGN_MESSAGE 256
#define CASE_FILES 256

typedef enum row_status { ROW_NONE, ROW_OK, ROW_REFUSED, ROW_FAILED, ROW_CRASHED, ROW_TIMED_OUT, ROW_GIVEN } row_status;

static const char *const row_words[] = {"none", "ok", "refused", "failed", "crashed", "timed_out", "given"};

typedef struct campaign_row { /* sent through pipes and by MPI as it is */
  int run;                    /* 0, 1, .. */
  row_status status;
  int by_library, unused; /* by_library: not by lanes (campaign_lanes.h) */
  uint64_t inputs;        /* digest of the scene's files and of the parameters */
  double measured[SCENE_MEASURES];
  char message[CAMPAIGN_MESSAGE];
} campaign_row;

enum { CASE_CHUNK = 8 }; /* runs at most that a worker is given at once */

typedef struct case_chunk {
  int n, run[CASE_CHUNK];
} case_chunk;

typedef struct campaign_worker {
  pid_t child; /* 0: none yet, or no more */
  int to, from, busy;
  int alone;       /* one run at a time: a worker that had several has died */
  case_chunk left; /* without a row so far */
} campaign_worker;

/* The one scene of a process, and its files. */
static scene case_scene;
static struct {
  int n, more; /* more: that there was no place for */
  char path[CASE_FILES][CAMPAIGN_PATH];
} case_files;

/* The digest, continued by a file; as it was, if there is none. */
static uint64_t case_add_file(uint64_t digest, const char *path)
{
  char bytes[4096];
  FILE *file = fopen(path, "r");
  while (file) {
    const size_t n = fread(bytes, 1, sizeof bytes, file);
    digest = campaign_digest(digest, bytes, n);
    if (n == 0) {
      fclose(file);
      return digest;
    }
  }
  return digest;
}

static void case_take_file(const char *path)
{
  int k = 0;
  while (k < case_files.n && strcmp(case_files.path[k], path) != 0) {
    k++;
  }
  if (k == CASE_FILES) {
    case_files.more++;
  } else if (k == case_files.n) {
    strcpy(case_files.path[case_files.n++], path);
  }
}

/* The scene's file, and all beside it that its words name. */
static void case_find_files(const campaign *c)
{
  char path[CAMPAIGN_PATH], message[TEXT_MESSAGE]; /* of what cannot be read scene_read tells */
  const char *word;
  struct stat at;
  text_file t;
  case_take_file(c->scene);
  if (text_try(&t, "", c->scene)) {
    t.message = message;
    while (text_line(&t)) {
      while ((word = text_word(&t)) != NULL) {
        if (campaign_beside(path, c->scene, word) && is_file(path, &at) && access(path, R_OK) == 0) {
          case_take_file(path);
        }
      }
    }
    text_close(&t);
  }
}

/* A digest of these files as they are now. */
static uint64_t case_digest(const campaign *c)
{
  uint64_t digest = CAMPAIGN_DIGEST;
  if (case_files.n == 0) {
    case_find_files(c);
  }
  for (int k = 0; k < case_files.n; k++) {
    digest = case_add_file(digest, case_files.path[k]);
  }
  return digest;
}

/* A digest of what a run starts from, by that of the scene's files: another process that has another one has seen other
   files, or another campaign. */
static uint64_t case_inputs(const campaign *c, uint64_t files, int run)
{
  double value[CAMPAIGN_VARY];
  char bytes[sizeof value];
  campaign_draw(c, value, run);
  memcpy(bytes, value, sizeof bytes);
  return campaign_digest(files, bytes, (size_t)c->n_vary * sizeof *value);
}

/* The settings of the scene in that run: those that are set, then those that vary. */
static int case_settings(const campaign *c, scene_setting *setting, int run)
{
  double value[CAMPAIGN_VARY];
  campaign_draw(c, value, run);
  for (int i = 0; i < c->n_set + c->n_vary; i++) {
    setting[i].name = i < c->n_set ? c->set[i].name : c->vary[i - c->n_set].name;
    setting[i].value = i < c->n_set ? c->set[i].value : value[i - c->n_set];
  }
  return c->n_set + c->n_vary;
}

/* The run itself, in the process that calls. */
static void case_run(const campaign *c, campaign_row *row, int run)
{
  static const scene_options quiet = {0};
  scene *const s = &case_scene;
  scene_setting setting[2 * CAMPAIGN_VARY];
  const int n = case_settings(c, setting, run);
  memset(row, 0, sizeof *row);
  row->run = run;
  row->inputs = case_inputs(c, case_digest(c), run);
  row->status = scene_read(s, c->scene, setting, n) ? ROW_REFUSED : scene_run(s, &quiet) ? ROW_FAILED : ROW_OK;
  snprintf(row->message, sizeof row->message, "%.*s", CAMPAIGN_MESSAGE - 1,
           row->status == ROW_OK ? s->warning : s->message);
  for (int i = 0; i < s->n_measure && row->status == ROW_OK; i++) {
    row->measured[i] = s->measured[i];
    if (!isfinite(s->measured[i])) {
      row->status = ROW_FAILED;
      snprintf(row->message, sizeof row->message, "%s is not finite", s->measure[i].label);
    }
  }
}

/* What runs a chunk in place of case_run, if anything: campaign_lanes.h. */
static void (*case_run_chunk)(const campaign *c, campaign_row row[CASE_CHUNK], const case_chunk *chunk);

/* Exactly n bytes; 0 when there are less. */
static int case_read(int from, void *bytes, size_t n)
{
  char *at = bytes;
  while (n > 0) {
    const ssize_t got = read(from, at, n);
    if (got > 0) {
      at += got;
      n -= (size_t)got;
    } else if (got == 0 || errno != EINTR) {
      return 0;
    }
  }
  return 1;
}

/* Less than a pipe takes at once. */
static int case_write(int to, const void *bytes, size_t n)
{
  return write(to, bytes, n) == (ssize_t)n;
}

/* ---- workers */

/* SIGPROF ends the process when it has worked that long; 0: never. */
static void worker_limit(double seconds)
{
  struct itimerval limit;
  memset(&limit, 0, sizeof limit);
  limit.it_value.tv_sec = (time_t)seconds;
  limit.it_value.tv_usec = (suseconds_t)(1e6 * fmod(seconds, 1));
  setitimer(ITIMER_PROF, &limit, NULL);
}

/* What a worker does, as long as it is told the numbers of runs. It does not heed interrupts from the keyboard, so that
   rows in hand are finished, and leaves no core file. */
static void worker_loop(const campaign *c, int from, int to)
{
  static campaign_row row[CASE_CHUNK];
  const struct rlimit no_core = {0, 0};
  case_chunk chunk;
  int good = 1;
  signal(SIGINT, SIG_IGN);
  signal(SIGTERM, SIG_IGN);
  signal(SIGPIPE, SIG_IGN);
  setrlimit(RLIMIT_CORE, &no_core);
  while (good && case_read(from, &chunk, sizeof chunk)) {
    worker_limit(c->cpu_limit * chunk.n);
    if (case_run_chunk) {
      case_run_chunk(c, row, &chunk);
    }
    for (int k = 0; k < chunk.n && !case_run_chunk; k++) {
      case_run(c, &row[k], chunk.run[k]);
    }
    worker_limit(0);
    for (int k = 0; k < chunk.n && good; k++) {
      good = case_write(to, &row[k], sizeof row[k]);
    }
  }
  _exit(0);
}

/* Waits for the end of one that has died or been killed. Returns how, as waitpid does. Workers forked later hold copies
   of the pipes of those before them: when the program dies, they end one after the other, the youngest first. */
static int worker_end(campaign_worker *w)
{
  int status = 0;
  close(w->to);
  close(w->from);
  while (w->child > 0 && waitpid(w->child, &status, 0) < 0 && errno == EINTR) {
  }
  w->child = 0;
  w->busy = 0;
  return status;
}

/* 0 when the system has no more processes or pipes. */
static int worker_begin(const campaign *c, campaign_worker *w)
{
  int to[2], from[2];
  if (pipe(to) != 0) {
    return 0;
  }
  if (pipe(from) != 0) {
    close(to[0]);
    close(to[1]);
    return 0;
  }
  fflush(NULL); /* what is in buffers is not the worker's */
  w->child = fork();
  if (w->child == 0) {
    close(to[1]);
    close(from[0]);
    worker_loop(c, to[0], from[1]);
  }
  close(to[0]);
  close(from[1]);
  w->to = to[1];
  w->from = from[0];
  if (w->child < 0) {
    worker_end(w);
    return 0;
  }
  return 1;
}

/* Hands out the runs that are left, or only the first of them, to a new worker if there is none or it died when it had
   nothing to do; 0 when none can be started. */
static int worker_send(const campaign *c, campaign_worker *w)
{
  case_chunk chunk = w->left;
  chunk.n = w->alone ? 1 : chunk.n;
  for (int attempt = 0; attempt < 2; attempt++) {
    if (w->child == 0 && !worker_begin(c, w)) {
      return 0;
    }
    w->busy = case_write(w->to, &chunk, sizeof chunk);
    if (w->busy) {
      return 1;
    }
    worker_end(w);
  }
  return 0;
}

/* Hands out runs. */
static int worker_give(const campaign *c, campaign_worker *w, const case_chunk *chunk)
{
  w->left = *chunk;
  w->alone = 0;
  return worker_send(c, w);
}

/* The run of the row that has come is no longer left. */
static void worker_strike(campaign_worker *w, int run)
{
  int n = 0;
  for (int k = 0; k < w->left.n; k++) {
    if (w->left.run[k] != run) {
      w->left.run[n++] = w->left.run[k];
    }
  }
  w->left.n = n;
}

/* Waits for a row, the next of those that were given; if the worker dies, the row of the run that it had says how. Had it
   several, they are given again one by one, so that none is lost by another: 0, there is no row now. */
static int worker_take(const campaign *c, campaign_worker *w, campaign_row *row)
{
  int status;
  if (case_read(w->from, row, sizeof *row)) {
    worker_strike(w, row->run);
    w->busy = w->left.n > 0;
    if (w->busy && w->alone) {
      (void)worker_send(c, w);
    }
    return 1;
  }
  status = worker_end(w);
  if (w->left.n > 1 && !w->alone) {
    w->alone = 1;
    if (worker_send(c, w)) {
      return 0;
    }
  }
  memset(row, 0, sizeof *row);
  row->run = w->left.run[0];
  worker_strike(w, row->run);
  if (w->left.n > 0) {
    (void)worker_send(c, w);
  }
  row->status = ROW_CRASHED;
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF) {
    row->status = ROW_TIMED_OUT;
    snprintf(row->message, sizeof row->message, "more than %g s of processor time (cpu_limit)", c->cpu_limit);
  } else if (WIFSIGNALED(status)) {
    snprintf(row->message, sizeof row->message, "ended by signal %d", WTERMSIG(status));
  } else {
    snprintf(row->message, sizeof row->message, "ended by exit(%d)", WEXITSTATUS(status));
  }
  return 1;
}
#endif
