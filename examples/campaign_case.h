/* campaign_case.h - one run of a campaign, in a process of its own: a run that crashes or does not end is a row like any other,
   and no run can leave anything behind for the next. POSIX (fork, pipe, waitpid, setitimer). */
#ifndef CAMPAIGN_CASE_H
#define CAMPAIGN_CASE_H
#include "campaign.h"
#include "scene_run.h"
#include <signal.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#define CAMPAIGN_MESSAGE 256

typedef enum row_status { ROW_NONE, ROW_OK, ROW_REFUSED, ROW_FAILED, ROW_CRASHED, ROW_TIMED_OUT, ROW_GIVEN } row_status;

static const char *const row_words[] = {"none", "ok", "refused", "failed", "crashed", "timed_out", "given"};

typedef struct campaign_row { /* sent through pipes and by MPI as it is */
  int run;                    /* 0, 1, .. */
  row_status status;
  uint64_t inputs; /* digest of the scene's files and of the parameters */
  double measured[SCENE_MEASURES];
  char message[CAMPAIGN_MESSAGE];
} campaign_row;

typedef struct campaign_case { /* one that runs */
  int run, pipe;
  pid_t child;
} campaign_case;

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

/* A digest of the scene's file and of all files beside it that its words name. */
static uint64_t case_digest(const campaign *c)
{
  uint64_t digest = case_add_file(CAMPAIGN_DIGEST, c->scene);
  char path[CAMPAIGN_PATH], no_message[TEXT_MESSAGE];
  const char *word;
  text_file t;
  if (text_open(&t, "", c->scene)) {
    t.message = no_message;
    while (text_line(&t)) {
      while ((word = text_word(&t)) != NULL) {
        digest = campaign_beside(path, c->scene, word) ? case_add_file(digest, path) : digest;
      }
    }
    text_close(&t);
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
  static scene s;
  static const scene_options quiet = {0};
  scene_setting setting[2 * CAMPAIGN_VARY];
  const int n = case_settings(c, setting, run);
  memset(row, 0, sizeof *row);
  row->run = run;
  row->inputs = case_inputs(c, case_digest(c), run);
  row->status = scene_read(&s, c->scene, setting, n) ? ROW_REFUSED : scene_run(&s, &quiet) ? ROW_FAILED : ROW_OK;
  snprintf(row->message, sizeof row->message, "%.*s", CAMPAIGN_MESSAGE - 1, row->status == ROW_OK ? "" : s.message);
  for (int i = 0; i < s.n_measure && row->status == ROW_OK; i++) {
    row->measured[i] = s.measured[i];
    if (!isfinite(s.measured[i])) {
      row->status = ROW_FAILED;
      snprintf(row->message, sizeof row->message, "%s is not finite", s.measure[i].label);
    }
  }
}

/* What the child does: the run, its row into the pipe. An interrupt from the keyboard leaves it alone, so that rows in hand
   are finished; no core files. */
static void case_child(const campaign *c, int run, int to)
{
  static campaign_row row;
  const struct rlimit no_core = {0, 0};
  struct itimerval limit;
  memset(&limit, 0, sizeof limit);
  limit.it_value.tv_sec = (time_t)c->cpu_limit;
  limit.it_value.tv_usec = (suseconds_t)(1e6 * fmod(c->cpu_limit, 1));
  signal(SIGINT, SIG_IGN);
  signal(SIGTERM, SIG_IGN);
  setrlimit(RLIMIT_CORE, &no_core);
  setitimer(ITIMER_PROF, &limit, NULL); /* ends it by SIGPROF */
  case_run(c, &row, run);
  _exit(write(to, &row, sizeof row) == (ssize_t)sizeof row ? 0 : 1);
}

/* Starts a run; 0 when the system has no more processes or pipes. */
static int case_begin(const campaign *c, campaign_case *k, int run)
{
  int end[2];
  if (pipe(end) != 0) {
    return 0;
  }
  fflush(NULL); /* what is in buffers is not the child's */
  k->run = run;
  k->pipe = end[0];
  k->child = fork();
  if (k->child == 0) {
    close(end[0]);
    case_child(c, run, end[1]);
  }
  close(end[1]);
  if (k->child < 0) {
    close(end[0]);
  }
  return k->child > 0;
}

/* Exactly n bytes; 0 when there are less. */
static int read_all_bytes(int from, void *bytes, size_t n)
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

/* Waits for its end, whichever it is. */
static void case_end(const campaign *c, campaign_case *k, campaign_row *row)
{
  const int whole = read_all_bytes(k->pipe, row, sizeof *row);
  int status = 0;
  close(k->pipe);
  while (waitpid(k->child, &status, 0) < 0 && errno == EINTR) {
  }
  k->child = 0;
  if (whole && WIFEXITED(status) && WEXITSTATUS(status) == 0) {
    return;
  }
  memset(row, 0, sizeof *row);
  row->run = k->run;
  row->status = ROW_CRASHED;
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF) {
    row->status = ROW_TIMED_OUT;
    snprintf(row->message, sizeof row->message, "more than %g s of processor time (cpu_limit)", c->cpu_limit);
  } else if (WIFSIGNALED(status)) {
    snprintf(row->message, sizeof row->message, "ended by signal %d", WTERMSIG(status));
  } else {
    snprintf(row->message, sizeof row->message, "ended by exit(%d)", WEXITSTATUS(status));
  }
}
#endif
