/* campaign_mpi - one scene over many sets of parameters on the processors of a cluster.

     mpirun -n 64 build/examples/campaign_mpi examples/campaigns/NAME.txt --runs 10000

   Every rank runs, rank 0 besides gives out the runs one by one and writes the journal. What runs is not the rank but a
   worker process (campaign_case.h) of a runner, which the rank has forked before MPI began: a run that crashes is a
   row, where a rank that crashed would end the whole job, and no process is forked that knows of MPI.
   campaigns/README.md. */
#define _POSIX_C_SOURCE 200809L
#define PROGRAM "campaign_mpi"
#define PROGRAM_LANES 0
#define CAMPAIGN_COMMAND "campaign_mpi"
#define CAMPAIGN_HELP "  (mpirun -n N: N runs at a time)\n"
#include "campaign_program.h"
#include "../common/output.h"
#include <mpi.h>
#include <sys/select.h>

enum { TAG_ROW, TAG_RUN };
enum { NO_RUN = -1 }; /* a rank's first word, and the last one to it */

typedef struct runner { /* the process that runs for a rank; run: that in hand, or NO_RUN */
  int to, from, run;
} runner;

static program prog;
static volatile sig_atomic_t interrupts;

static void interrupt(int signal_number)
{
  (void)signal_number;
  interrupts++;
}

/* What the runner does: it reads the campaign when the first run comes, rank 0 has then found it good. */
static void runner_loop(int argc, char **argv, int from, int to)
{
  static campaign_row row;
  campaign_worker worker = {0};
  case_chunk chunk = {1, {0}};
  int run, ready = 0;
  while (case_read(from, &run, sizeof run)) {
    if (!ready++ && program_read(&prog, argc, argv)) {
      break;
    }
    chunk.run[0] = run;
    if (!worker_give(&prog.c, &worker, &chunk)) {
      break;
    }
    (void)worker_take(&prog.c, &worker, &row);
    if (!case_write(to, &row, sizeof row)) {
      break;
    }
  }
  _exit(0);
}

/* 0 when it cannot be started. */
static int runner_begin(runner *r, int argc, char **argv)
{
  int to[2], from[2];
  pid_t child;
  r->run = NO_RUN;
  if (pipe(to) != 0 || pipe(from) != 0) {
    return 0;
  }
  child = fork();
  if (child == 0) {
    close(to[1]);
    close(from[0]);
    runner_loop(argc, argv, to[0], from[1]);
  }
  close(to[0]);
  close(from[1]);
  r->to = to[1];
  r->from = from[0];
  return child > 0;
}

/* Hands it a run; 0 when there is no runner any more. */
static int runner_give(runner *r, int run)
{
  r->run = run;
  return case_write(r->to, &run, sizeof run);
}

/* Waits for its row; without a runner the row says that the run is with nobody. */
static void runner_take(runner *r, campaign_row *row)
{
  if (!case_read(r->from, row, sizeof *row)) {
    memset(row, 0, sizeof *row);
    row->run = r->run;
    row->status = ROW_NONE;
  }
  r->run = NO_RUN;
}

/* Ranks beside 0: the row of the last run for the number of the next, until there is none. */
static void serve(runner *r)
{
  static campaign_row row;
  row.run = NO_RUN;
  for (;;) {
    int run;
    MPI_Send(&row, (int)sizeof row, MPI_BYTE, 0, TAG_ROW, MPI_COMM_WORLD);
    if (row.run != NO_RUN && row.status == ROW_NONE) {
      return; /* its runner has died: it takes no part any more */
    }
    MPI_Recv(&run, 1, MPI_INT, 0, TAG_RUN, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    if (run == NO_RUN) {
      return;
    }
    runner_give(r, run);
    runner_take(r, &row);
  }
}

/* A row that has come; 1 when its rank goes on, 0 when its runner has died. */
static int take_row(campaign_row *row, int rank, int *status)
{
  if (row->run == NO_RUN) {
    return 1;
  }
  if (row->status == ROW_NONE) {
    fprintf(stderr, PROGRAM ": rank %d has lost its runner; run %d goes to another\n", rank, row->run + 1);
    ledger_return(&prog.l, row->run);
    return 0;
  }
  *status = *status ? *status : ledger_add(&prog.l, row);
  return 1;
}

/* Rank 0: takes the messages that are there, answers each with a run. How many ranks are left. */
static int answer(int others, int *status)
{
  static campaign_row row;
  MPI_Status from;
  int there = 1, run;
  while (others > 0 && there) {
    MPI_Iprobe(MPI_ANY_SOURCE, TAG_ROW, MPI_COMM_WORLD, &there, &from);
    if (!there) {
      break;
    }
    MPI_Recv(&row, (int)sizeof row, MPI_BYTE, from.MPI_SOURCE, TAG_ROW, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    run = NO_RUN;
    if (take_row(&row, from.MPI_SOURCE, status)) {
      run = interrupts || *status ? NO_RUN : ledger_next(&prog.l);
      MPI_Send(&run, 1, MPI_INT, from.MPI_SOURCE, TAG_RUN, MPI_COMM_WORLD);
    }
    others -= run == NO_RUN;
  }
  return others;
}

/* Is the row of rank 0's own runner there? Waits 0.2 ms at most while there are others to answer: no core is kept
   busy. */
static int own_row(const runner *own, int others)
{
  struct timeval time = {others ? 0 : 1, others ? 200 : 0};
  fd_set ready;
  FD_ZERO(&ready);
  if (own->run != NO_RUN) {
    FD_SET(own->from, &ready);
  }
  return select(own->from + 1, &ready, NULL, NULL, &time) > 0;
}

/* Rank 0: its own runs, and those of the others. */
static int coordinate(runner *own, int others)
{
  static campaign_row row;
  int status = 0, alive = 1, run;
  do {
    run = alive && own->run == NO_RUN && !interrupts && !status ? ledger_next(&prog.l) : NO_RUN;
    if (run != NO_RUN) {
      runner_give(own, run);
    }
    if (own_row(own, others)) {
      runner_take(own, &row);
      alive = take_row(&row, 0, &status);
    }
    others = answer(others, &status);
  } while (others > 0 || own->run != NO_RUN || (alive && !interrupts && !status && prog.l.next < prog.c.runs));
  return status;
}

/* What the command line asks for and no rank does. */
static int is_for_one_machine(void)
{
  return prog.run > 0    ? fail("no such option: the program campaign has it", "--run")
         : prog.jobs > 0 ? fail("no such option: mpirun -n N says how many runs at a time", "--jobs")
                         : 0;
}

static int asks_for_help(int argc, char **argv)
{
  int asks = 0;
  for (int i = 1; i < argc; i++) {
    asks |= strcmp(argv[i], "--help") == 0;
  }
  return asks;
}

int main(int argc, char **argv)
{
  static runner own;
  int began, rank, ranks, status = 0;
  output_begin(PROGRAM);
  signal(SIGPIPE, SIG_IGN); /* a runner that has died is missed when its row is read */
  signal(SIGINT, interrupt);
  signal(SIGTERM, interrupt);
  began = runner_begin(&own, argc, argv);
  MPI_Init(NULL, NULL);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  if (asks_for_help(argc, argv)) {
    fputs(rank == 0 ? campaign_help : "", stdout);
    MPI_Finalize();
    return 0;
  }
  if (!began) {
    fprintf(stderr, PROGRAM ": rank %d cannot start a process: %s\n", rank, strerror(errno));
    MPI_Abort(MPI_COMM_WORLD, 2);
  }
  if (rank == 0) {
    status = program_read(&prog, argc, argv);
    status = status ? status : is_for_one_machine();
    status = status ? status : program_open(&prog);
  }
  MPI_Bcast(&status, 1, MPI_INT, 0, MPI_COMM_WORLD);
  if (!status && rank == 0) {
    status = coordinate(&own, ranks - 1);
    status = status ? status : program_close(&prog);
  } else if (!status) {
    serve(&own);
  }
  MPI_Finalize();
  return rank == 0 ? status : 0;
}
