/* campaign - one scene over many sets of parameters on all cores of this machine.

     build/flexbeam campaign examples/campaigns/NAME.txt --runs 1000

   As many runs at a time as there are processors, each in a worker process, so that one that crashes is a row like any
   other; a worker that is free gets the next run. campaigns/README.md. */
#define _POSIX_C_SOURCE 200809L
#define PROGRAM "campaign"
#define PROGRAM_LANES 1
#define CAMPAIGN_COMMAND "flexbeam campaign"
#define CAMPAIGN_HELP                                                                                            \
  "  --jobs N              runs at a time (as many as processors)\n"                                             \
  "  --lanes N             by equations of their own, compiled with $CC, N = 1, 2, 4 or 8 runs at once on each " \
  "processor\n"                                                                                                  \
  "  --run K               just run K, in this process; the command for the same scene\n"
#include "campaign_program.h"
#include "campaign_lanes.h"
#include "../tools/words.h"
#include "../common/output.h"
#include <poll.h>

#define JOBS 1024

static program prog;
static campaign_worker worker[JOBS];
static int by_library; /* rows that did not go by lanes */
static volatile sig_atomic_t interrupts;

static void interrupt(int signal_number)
{
  (void)signal_number;
  interrupts++;
}

/* A first interrupt lets the runs in hand end, a second one does not. */
static void watch_signals(void)
{
  struct sigaction action;
  memset(&action, 0, sizeof action);
  action.sa_handler = interrupt;
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  signal(SIGPIPE, SIG_IGN); /* a worker that has died is noticed without it */
}

/* Workers that are free get runs, while there are any; how many are busy now, -1 when none can be started. */
static int give_runs(int jobs, int busy)
{
  for (int i = 0; i < jobs && !interrupts; i++) {
    if (!worker[i].busy) {
      const int most = prog.lanes > 0 ? (int)prog.lanes : 1;
      case_chunk chunk = {0, {0}};
      for (int run; chunk.n < most && (run = ledger_next(&prog.l)) >= 0;) {
        chunk.run[chunk.n++] = run;
      }
      if (chunk.n == 0) {
        break;
      }
      if (!worker_give(&prog.c, &worker[i], &chunk)) {
        for (int k = 0; k < chunk.n; k++) {
          ledger_return(&prog.l, chunk.run[k]);
        }
        return busy > 0 ? busy : -1; /* those that are there go on */
      }
      busy++;
    }
  }
  return busy;
}

/* Waits until a run has ended; takes all that have. */
static int take_rows(int jobs, int *busy)
{
  static struct pollfd at[JOBS];
  static campaign_row row;
  int status = 0;
  for (int i = 0; i < jobs; i++) {
    at[i].fd = worker[i].busy ? worker[i].from : -1;
    at[i].events = POLLIN;
    at[i].revents = 0;
  }
  if (poll(at, (nfds_t)jobs, 500) <= 0) {
    return 0;
  }
  for (int i = 0; i < jobs && !status; i++) {
    if (at[i].revents) {
      if (worker_take(&prog.c, &worker[i], &row)) {
        status = ledger_add(&prog.l, &row);
        by_library += row.by_library && row.status == ROW_OK;
      }
      for (int k = 0; k < worker[i].left.n && !worker[i].busy; k++) { /* no process can be started for them now */
        ledger_return(&prog.l, worker[i].left.run[k]);
      }
      *busy -= !worker[i].busy;
    }
  }
  return status;
}

static int work(int jobs)
{
  int status = 0, busy = 0, told = 0;
  while (!status && interrupts < 2 && (busy = give_runs(jobs, busy)) != 0) {
    if (busy < 0) {
      return fail("no process can be started", strerror(errno));
    }
    if (interrupts && !told++) {
      int runs = 0;
      for (int i = 0; i < jobs; i++) {
        runs += worker[i].busy ? worker[i].left.n : 0;
      }
      fprintf(stderr, "\n" PROGRAM ": interrupted; waits for %d run%s in hand (once more: at once)\n", runs,
              runs > 1 ? "s" : "");
    }
    status = take_rows(jobs, &busy);
  }
  for (int i = 0; i < jobs; i++) {
    if (worker[i].child) { /* no row of it is wanted any more */
      kill(worker[i].child, SIGKILL);
      worker_end(&worker[i]);
    }
  }
  return status;
}

/* One run for a closer look, with a debugger if need be, and how `flexbeam scene` runs it, to a CSV file and
   pictures. */
static int run_one(int run)
{
  static campaign_row row;
  scene_setting setting[2 * CAMPAIGN_VARY];
  const int n = case_settings(&prog.c, setting, run);
  printf("flexbeam scene %s", prog.c.scene);
  for (int i = 0; i < n; i++) {
    printf(" --set %s=%.17g", setting[i].name, setting[i].value);
  }
  printf("\n");
  fflush(stdout);
  if (prog.lanes > 0) {
    const case_chunk chunk = {1, {run}};
    campaign_row rows[CASE_CHUNK];
    lanes_rows(&prog.c, rows, &chunk);
    row = rows[0];
  } else {
    case_run(&prog.c, &row, run);
  }
  for (int i = 0; i < prog.l.n_measure && row.status == ROW_OK; i++) {
    printf("%-20s %.17g\n", prog.l.label[i], row.measured[i]);
  }
  printf("%s %s\n", row_words[row.status], row.message);
  return row.status != ROW_OK;
}

static int run_is_there(void)
{
  char what[64];
  snprintf(what, sizeof what, "--run: the campaign has %d run%s", prog.c.runs, prog.c.runs > 1 ? "s" : "");
  return prog.run > prog.c.runs ? fail(what, "") : 0;
}

/* The equations of the scene for --lanes; a status of main. */
static int compile_lanes(void)
{
  char why[200];
  const int status = prog.lanes > 0 ? program_scene(&prog) : 0;
  if (status || !(prog.lanes > 0)) {
    return status;
  }
  case_run_chunk = lanes_rows;
  return lanes_begin(&prog.c, (int)prog.lanes, why) ? 0 : fail("--lanes", why);
}

int campaign_main(int argc, char **argv)
{
  const long processors = sysconf(_SC_NPROCESSORS_ONLN);
  int status;
  output_begin(PROGRAM);
  status = program_read(&prog, argc, argv);
  if (!status && prog.run > 0) {
    status = run_is_there();
    status = status ? status : compile_lanes();
    status = status ? status : program_scene(&prog);
    return status ? status : run_one((int)prog.run - 1);
  }
  watch_signals(); /* before there is a temporary folder */
  status = status ? status : compile_lanes();
  status = status ? status : program_open(&prog);
  if (status) {
    return status;
  }
  status = work(prog.jobs > 0 ? (int)prog.jobs : processors > 0 && processors < JOBS ? (int)processors : 1);
  if (by_library > 0) {
    fprintf(stderr, PROGRAM ": %d runs went by the library, not by lanes: more than numbers varies in them\n",
            by_library);
  }
  return status ? status : program_close(&prog);
}
