/* campaign_program.h - what the campaign on one machine (campaign.c) and that by MPI (campaign_mpi.c) share: their
   options, their beginning and their end. Define PROGRAM, CAMPAIGN_COMMAND, CAMPAIGN_HELP, the lines of --help that are
   its own, and PROGRAM_LANES, whether it has --lanes. */
#ifndef CAMPAIGN_PROGRAM_H
#define CAMPAIGN_PROGRAM_H
#include "campaign_report.h"
#include "../common/options.h"
#include "../common/same_file.h"

typedef struct program {
  campaign c;
  ledger l;
  const char *file; /* NULL: all is on the command line */
  char csv[CAMPAIGN_PATH + 16], journal[CAMPAIGN_PATH + 32];
  double jobs, run, pictures, lanes; /* of the command line */
  int fresh, retry;
} program;

static const char campaign_help[] =
    "Runs one scene over many sets of parameters. " CAMPAIGN_COMMAND " [FILE] [options]\n"
    "FILE describes the campaign, a word and its values per line; as an option --WORD \"VALUES\" a word overrides it:\n"
    "  scene FILE            the scene (examples/scenes/README.md), as seen from FILE\n"
    "  runs N                how many (100 of every combination of lists and grids)\n"
    "  vary NAME normal MEAN SD | lognormal MEAN SD | uniform A B    drawn; SD is a number or a part of the mean: 5%\n"
    "  vary NAME list V1 V2 ..  |  grid A B N                        every combination of them\n"
    "  set NAME VALUE        another value for all runs\n"
    "  correlate NAME NAME R draws of normal (the logarithms of lognormal) parameters, -1 < R < 1\n"
    "  require MEASURE above|below LIMIT  how many of the runs that are ok meet it is told\n"
    "  latin                 each of N equally likely intervals of a drawn parameter is met by one of N runs\n"
    "  seed S                of the draws, 0 to 2^53 (1)\n"
    "  cpu_limit S           processor time of a run [s] (3600)\n"
    "options\n" CAMPAIGN_HELP
    "  --out FILE.csv        the rows (FILE with .csv in the working directory); the journal is beside: FILE.journal\n"
    "  --fresh               throw the journal away and begin anew; without, runs that are in it are not run again\n"
    "  --retry               run again what failed\n"
    "  --pictures 0          no pictures (1: if gnuplot is installed)\n"
    "  --quiet               no progress line\n"
    "Results do not depend on the number of processes, nor on the order of the runs, nor on a restart.\n"
    "Exit status: 0 all runs ok, 1 some failed, 2 refused, 3 interrupted (start it again to go on).\n";

static int program_option(void *options, const char *name, const char *text)
{
  program *p = options;
  const number_option numbers[] = {{"--jobs", &p->jobs, 1, 1024},
                                   {"--run", &p->run, 1, CAMPAIGN_RUNS},
                                   {"--pictures", &p->pictures, 0, 1},
                                   {"--lanes", &p->lanes, 1, 8}};
  if (strcmp(name, "--out") == 0) {
    return snprintf(p->csv, sizeof p->csv, "%.*s", CAMPAIGN_PATH, text) < CAMPAIGN_PATH && text[0]
               ? 0
               : fail("--out wants a file name of less than 400 characters", "");
  }
  if (strncmp(name, "--", 2) != 0 || campaign_word(name + 2) == CAMPAIGN_WORDS) {
    const int status = read_number(numbers, PROGRAM_LANES ? 4 : 3, name, text);
    const int lanes = (int)p->lanes, good = (double)lanes >= p->lanes && (lanes & (lanes - 1)) == 0;
    return status || (p->jobs == floor(p->jobs) && p->run == floor(p->run) && good)
               ? status
               : fail(good ? "a whole number is wanted" : "1, 2, 4 or 8 is wanted", name);
  }
  return campaign_option(&p->c, PROGRAM, name, text);
}

/* The command line and the file that it names; a status of main. */
static int program_read(program *p, int argc, char **argv)
{
  struct stat at;
  int status = 0;
  memset(p, 0, sizeof *p);
  campaign_default(&p->c);
  scene_draws = 0;
  p->pictures = 1;
  p->fresh = take_flag(&argc, argv, "--fresh");
  p->retry = take_flag(&argc, argv, "--retry");
  p->l.quiet = take_flag(&argc, argv, "--quiet");
  if (argc > 1 && argv[1][0] != '-') {
    const char *slash = strrchr(argv[1], '/');
    p->file = argv[1];
    other_name(p->csv, sizeof p->csv, slash ? slash + 1 : argv[1], ".csv");
    status = campaign_file(&p->c, PROGRAM, p->file);
    argc--;
    argv++;
  } else {
    strcpy(p->csv, "campaign.csv");
  }
  status = status ? status : read_all(argc, argv, campaign_help, program_option, p);
  other_name(p->journal, sizeof p->journal, p->csv, ".journal");
  status = status ? status : campaign_complete(&p->c, PROGRAM, p->file ? p->file : "command line");
  if (!status && stat(p->c.scene, &at) == 0 && !S_ISREG(at.st_mode)) {
    return fail("the scene wants a file: it is read for every run", p->c.scene);
  }
  return status;
}

static int fail_scene(const campaign *c, const char *what, const char *name)
{
  char why[CAMPAIGN_PATH + 64];
  snprintf(why, sizeof why, "%s has no %s", c->scene, what);
  return fail(why, name);
}

/* Every column of the rows has a name of its own. */
static int program_columns(const program *p)
{
  static const char *const own[] = {"run", "status", "message"};
  const campaign *c = &p->c;
  for (int k = 0; k < c->n_vary + p->l.n_measure; k++) {
    const char *name = k < c->n_vary ? c->vary[k].name : p->l.label[k - c->n_vary];
    int taken = k >= c->n_vary && campaign_find(c, name) >= 0;
    for (int i = 0; i < 3; i++) {
      taken |= strcmp(name, own[i]) == 0;
    }
    if (taken) {
      return fail("two columns of the rows would have the name", name);
    }
  }
  return 0;
}

/* The scene as it is must be good, and have the parameters; what it measures becomes the columns. */
static int program_scene(program *p)
{
  scene *const s = &case_scene;
  const campaign *c = &p->c;
  if (scene_read(s, c->scene, NULL, 0)) {
    return fail(s->message, "");
  }
  for (int i = 0; i < c->n_vary + c->n_set; i++) {
    const char *name = i < c->n_vary ? c->vary[i].name : c->set[i - c->n_vary].name;
    int k = 0;
    while (k < s->n_parameter && strcmp(name, s->parameter[k].name) != 0) {
      k++;
    }
    if (k == s->n_parameter) {
      return fail_scene(c, "parameter", name);
    }
  }
  if (s->n_measure == 0) {
    return fail("the scene measures nothing (`measure LABEL KIND OUTPUT`)", c->scene);
  }
  p->l.n_measure = s->n_measure;
  for (int k = 0; k < s->n_measure; k++) {
    const scene_measure *m = &s->measure[k];
    const char *unit =
        m->kind < SCENE_FREQUENCY ? s->output[m->output].unit : scene_kind_units[m->kind - SCENE_FREQUENCY];
    strcpy(p->l.label[k], m->label);
    snprintf(p->l.title[k], sizeof p->l.title[k], "%s [%s]", m->label, unit);
  }
  for (int k = 0; k < c->n_require; k++) {
    if (ledger_measure(&p->l, c->require[k].measure) < 0) {
      return fail_scene(c, "measure", c->require[k].measure);
    }
  }
  return program_columns(p);
}

/* What is written is not what is read, nor each other. */
static int program_files(const program *p)
{
  const char *const out[] = {p->csv, p->journal};
  struct stat at;
  if (stat(p->csv, &at) == 0 && !S_ISREG(at.st_mode)) {
    return fail("--out wants a file: the journal goes beside it", p->csv);
  }
  if (strcmp(p->csv, p->journal) == 0 || same_file(p->csv, p->journal)) {
    return fail("--out: that is the journal of the campaign", p->csv);
  }
  for (int i = 0; i < 2; i++) {
    if (p->file && same_file(out[i], p->file)) {
      return fail("--out would write over the campaign", out[i]);
    }
    for (int k = 0; k < case_files.n; k++) {
      if (same_file(out[i], case_files.path[k])) {
        return fail("--out would write over what the campaign reads", out[i]);
      }
    }
  }
  return 0;
}

/* The scene, the journal; a status of main. */
static int program_open(program *p)
{
  int status;
  p->l.c = &p->c;
  p->l.program = PROGRAM;
  p->l.scene = case_digest(&p->c);
  p->l.by_lanes = p->lanes > 0;
  status = case_files.more ? fail("the scene names more files than 256", p->c.scene) : program_scene(p);
  status = status ? status : program_files(p);
  status = status ? status : ledger_open(&p->l, p->journal, p->fresh);
  if (!status && p->retry) {
    ledger_retry(&p->l);
  }
  if (!status && p->l.found > 0 && !p->l.quiet) {
    fprintf(stderr, PROGRAM ": %d of %d runs are in %s\n", p->l.found, p->c.runs, p->journal);
  }
  return status;
}

/* The rows and what they tell; a status of main. */
static int program_close(program *p)
{
  const int status = report_write(&p->l, p->csv, p->pictures > 0);
  if (status == 3) {
    fprintf(stderr, PROGRAM ": %d of %d runs are done; the same command goes on with the others\n", p->l.done,
            p->c.runs);
  }
  return status;
}
#endif
