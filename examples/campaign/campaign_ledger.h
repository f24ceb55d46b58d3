/* campaign_ledger.h - which runs of a campaign are done, and with what result: in memory, and in a journal beside the
   results, one line per run, written when the run ends. A campaign that was killed goes on where its journal ends. The
   journal begins with what determines the results; that of another campaign is refused. Every line ends with a check
   word, so that a line that was torn or damaged counts as not written. Only one process writes (rank 0 of an MPI
   program). */
#ifndef CAMPAIGN_LEDGER_H
#define CAMPAIGN_LEDGER_H
#include "../common/clock.h"
#include "campaign_case.h"
#include <fcntl.h>
#include <sys/stat.h>

#define LEDGER_LINE 8192 /* more than a list of CAMPAIGN_VALUES takes */
#define LEDGER_HEAD 65536

typedef struct ledger {
  const campaign *c;
  const char *program, *path;
  FILE *journal;
  int n_measure, next, done, failed, found, damaged; /* found: in the journal */
  int by_lanes;                                      /* rows are those of campaign_lanes.h */
  uint64_t scene;
  char label[SCENE_MEASURES][TEXT_NAME];
  char title[SCENE_MEASURES][2 * TEXT_NAME + 4]; /* with the unit */
  char head[LEDGER_HEAD];
  unsigned char *status; /* row_status of each run */
  double *measured;      /* n_measure of each run */
  char **message;        /* NULL: none */
  double began, said;    /* [ns] */
  int quiet, on_terminal;
} ledger;

static int ledger_fail(const ledger *l, const char *what, const char *why)
{
  fprintf(stderr, "%s: %s: %s\n", l->program, what, why);
  return 2;
}

/* The shortest decimal number that reads back as x. */
static void ledger_number(char text[32], double x)
{
  for (int digits = 15; digits <= 17; digits++) {
    snprintf(text, 32, "%.*g", digits, x);
    if (strtod(text, NULL) == x) { /* NOLINT: equal to the last bit */
      return;
    }
  }
}

/* ---- the head: what determines the results */

static void ledger_add_head(ledger *l, const char *format, ...)
{
  const size_t n = strlen(l->head);
  va_list list;
  va_start(list, format);
  vsnprintf(l->head + n, sizeof l->head - n, format, list);
  va_end(list);
}

static void ledger_add_vary(ledger *l, const campaign_vary *v)
{
  char a[32], b[32];
  ledger_number(a, v->a);
  ledger_number(b, v->b);
  ledger_add_head(l, "vary %s %s", v->name, campaign_kinds[v->kind]);
  if (v->kind != CAMPAIGN_LIST) {
    ledger_add_head(l, v->kind == CAMPAIGN_GRID ? " %s %s %d" : " %s %s", a, b, v->n);
  }
  for (int k = 0; k < v->n && v->kind == CAMPAIGN_LIST; k++) {
    ledger_number(a, v->value[k]);
    ledger_add_head(l, " %s", a);
  }
  ledger_add_head(l, "\n");
}

/* The number of runs is part of it only where it matters: more runs later keep those that are done. The limit of
   processor time is not: rows that met it are done again by --retry, under another. */
static void ledger_make_head(ledger *l)
{
  const campaign *c = l->c;
  char number[32];
  l->head[0] = 0;
  ledger_add_head(l, "campaign journal 1 of flexbeam %s %s\n", fb_version_string(), fb_config_string());
  ledger_add_head(l, "scene %016llx\nseed %llu\n", (unsigned long long)l->scene, (unsigned long long)c->seed);
  if (c->latin) {
    ledger_add_head(l, "latin of %d runs\n", c->runs);
  }
  for (int k = 0; k < c->n_set; k++) {
    ledger_number(number, c->set[k].value);
    ledger_add_head(l, "set %s %s\n", c->set[k].name, number);
  }
  for (int k = 0; k < c->n_vary; k++) {
    ledger_add_vary(l, &c->vary[k]);
  }
  for (int k = 0; k < c->n_pair; k++) {
    ledger_number(number, c->pair[k].rho);
    ledger_add_head(l, "correlate %s %s %s\n", c->vary[c->pair[k].a].name, c->vary[c->pair[k].b].name, number);
  }
  ledger_add_head(l, l->by_lanes ? "lanes\nmeasures" : "measures");
  for (int k = 0; k < l->n_measure; k++) {
    ledger_add_head(l, " %s", l->label[k]);
  }
  ledger_add_head(l, "\nrows\n");
}

/* ---- lines of the journal */

static void ledger_put(FILE *to, const char *line, size_t n)
{
  fprintf(to, "%.*s *%016llx\n", (int)n, line, (unsigned long long)campaign_digest(CAMPAIGN_DIGEST, line, n));
}

/* The next line without its check word: 1, -1 if it is torn or damaged, 0 at the end. */
static int ledger_get(FILE *from, char line[LEDGER_LINE])
{
  size_t n;
  char check[20];
  if (!fgets(line, LEDGER_LINE, from)) {
    return 0;
  }
  n = strlen(line);
  if (n < 19 || line[n - 1] != '\n') {
    return -1;
  }
  n -= 19;
  snprintf(check, sizeof check, " *%016llx\n", (unsigned long long)campaign_digest(CAMPAIGN_DIGEST, line, n));
  if (strcmp(line + n, check) != 0) {
    return -1;
  }
  line[n] = 0;
  return 1;
}

/* The column of a measure, -1 if it is none. */
static int ledger_measure(const ledger *l, const char *label)
{
  int k = l->n_measure - 1;
  while (k >= 0 && strcmp(l->label[k], label) != 0) {
    k--;
  }
  return k;
}

/* ---- rows */

static double *ledger_measured(const ledger *l, int run)
{
  return l->measured + (size_t)run * (size_t)l->n_measure;
}

static void ledger_keep(ledger *l, int run, row_status status, const double *measured, const char *message)
{
  const row_status before = (row_status)l->status[run];
  l->done += before == ROW_NONE || before == ROW_GIVEN;
  l->failed += (status != ROW_OK) - (before != ROW_OK && before != ROW_NONE && before != ROW_GIVEN);
  l->status[run] = (unsigned char)status;
  memcpy(ledger_measured(l, run), measured, (size_t)l->n_measure * sizeof *measured);
  free(l->message[run]);
  l->message[run] = NULL;
  if (message[0]) {
    const size_t n = strlen(message) + 1;
    l->message[run] = malloc(n);
    if (l->message[run]) {
      memcpy(l->message[run], message, n);
    }
  }
}

/* A row of the journal: RUN STATUS MEASURES [MESSAGE]; 0 if it is none. */
static int ledger_read_row(ledger *l, const char *line)
{
  double measured[SCENE_MEASURES] = {0};
  char *end;
  const long run = strtol(line, &end, 10);
  int status = ROW_OK;
  const char *at = end + (*end == ' ');
  while (status < ROW_GIVEN && strncmp(at, row_words[status], strlen(row_words[status])) != 0) {
    status++;
  }
  if (run < 1 || status == ROW_GIVEN) {
    return 0;
  }
  at += strlen(row_words[status]);
  for (int k = 0; k < l->n_measure && status == ROW_OK; k++) {
    measured[k] = strtod(at, &end);
    if (end == at) {
      return 0;
    }
    at = end;
  }
  if (run <= l->c->runs) { /* there may have been more of them */
    ledger_keep(l, (int)run - 1, (row_status)status, measured, at + (*at == ' '));
  }
  return 1;
}

static void ledger_write_row(const ledger *l, int run)
{
  char line[LEDGER_LINE], number[32];
  int n = snprintf(line, sizeof line, "%d %s", run + 1, row_words[l->status[run]]);
  for (int k = 0; k < l->n_measure && l->status[run] == ROW_OK; k++) {
    ledger_number(number, ledger_measured(l, run)[k]);
    n += snprintf(line + n, sizeof line - (size_t)n, " %s", number);
  }
  if (l->message[run]) {
    n += snprintf(line + n, sizeof line - (size_t)n, " %s", l->message[run]);
  }
  ledger_put(l->journal, line, (size_t)n);
}

/* ---- the journal */

static const char ledger_in_use[] = "another process is at work on this campaign";

/* A new one: under a name that no other process has until its head is whole; in place of the old one, which is locked,
   or where there is none, if nobody else was faster. */
static int ledger_create(ledger *l, int replaces)
{
  char fresh[CAMPAIGN_PATH + 64];
  FILE *file;
  int ok = 0;
  snprintf(fresh, sizeof fresh, "%s.%ld.new", l->path, (long)getpid());
  file = fopen(fresh, "w");
  if (file) {
    for (const char *at = l->head; *at; at = strchr(at, '\n') + 1) {
      ledger_put(file, at, strcspn(at, "\n"));
    }
    ok = !ferror(file);
    ok = fclose(file) == 0 && ok && (replaces ? rename(fresh, l->path) : link(fresh, l->path)) == 0;
    if (!ok || !replaces) {
      const int error = errno;
      unlink(fresh);
      errno = error;
    }
  }
  return ok ? 0 : ledger_fail(l, l->path, errno == EEXIST ? ledger_in_use : strerror(errno));
}

/* What line `at` of the head is in the journal: with its check word. */
static void ledger_whole(char whole[LEDGER_LINE], const char *at)
{
  const size_t n = strcspn(at, "\n");
  snprintf(whole, LEDGER_LINE, "%.*s *%016llx\n", (int)n, at,
           (unsigned long long)campaign_digest(CAMPAIGN_DIGEST, at, n));
}

/* Is the head of the journal that of this campaign? 0: yes; 2: no, after a message; 1: it is as far as it goes, and
   ends before the rows, of which nothing is lost. */
static int ledger_read_head(const ledger *l)
{
  static char line[LEDGER_LINE], whole[LEDGER_LINE], why[2 * LEDGER_LINE];
  int number = 1;
  for (const char *at = l->head; *at; at = strchr(at, '\n') + 1, number++) {
    const size_t n = strcspn(at, "\n");
    int got;
    line[0] = 0;
    got = ledger_get(l->journal, line);
    ledger_whole(whole, at);
    if (got != 1 && getc(l->journal) == EOF && strncmp(line, whole, strlen(line)) == 0) {
      return 1;
    }
    if (got != 1) {
      snprintf(why, sizeof why,
               "is no journal of a campaign, or line %d of it is damaged: nobody can tell whose runs it has "
               "(--fresh throws it away)",
               number);
      return ledger_fail(l, l->path, why);
    }
    if (strlen(line) != n || strncmp(line, at, n) != 0) {
      snprintf(why, sizeof why,
               "is the journal of another campaign: it says `%s`, this one `%.*s` (--fresh throws it away)", line,
               (int)n, at);
      return ledger_fail(l, l->path, why);
    }
  }
  return 0;
}

static int ledger_read_rows(ledger *l)
{
  char line[LEDGER_LINE];
  int got, ends = 1;
  while ((got = ledger_get(l->journal, line)) != 0) {
    ends = strchr(line, '\n') != NULL || got == 1;
    l->damaged += got != 1 || !ledger_read_row(l, line);
  }
  l->found = l->done;
  if (l->damaged) {
    fprintf(stderr, "%s: %s: %d line%s torn or damaged: those runs are done again\n", l->program, l->path, l->damaged,
            l->damaged > 1 ? "s are" : " is");
  }
  fseek(l->journal, 0, SEEK_END);
  if (!ends) {
    fputc('\n', l->journal); /* a new line for what comes now */
  }
  return ferror(l->journal) ? ledger_fail(l, l->path, strerror(errno)) : 0;
}

/* Nobody else writes it, nor has put another in its place meanwhile. */
static int ledger_lock(const ledger *l)
{
  struct flock all;
  struct stat mine, there;
  memset(&all, 0, sizeof all);
  all.l_type = F_WRLCK;
  all.l_whence = SEEK_SET;
  if (fcntl(fileno(l->journal), F_SETLK, &all) != 0 && (errno == EACCES || errno == EAGAIN)) {
    return ledger_fail(l, l->path, ledger_in_use);
  }
  if (fstat(fileno(l->journal), &mine) != 0 || stat(l->path, &there) != 0 || mine.st_ino != there.st_ino) {
    return ledger_fail(l, l->path, ledger_in_use);
  }
  return 0;
}

/* A new journal, in place of the one that is open; a status of main. */
static int ledger_renew(ledger *l)
{
  FILE *const old = l->journal; /* locked until there is the new one */
  int status = ledger_create(l, old != NULL);
  l->journal = status ? NULL : fopen(l->path, "r+");
  status = status ? status : l->journal ? ledger_lock(l) : ledger_fail(l, l->path, strerror(errno));
  if (old) {
    fclose(old);
  }
  return status ? status : ledger_read_head(l);
}

/* The journal, where there is one and it is wanted: it has the head of this campaign, or is renewed; a status of main. */
static int ledger_find(ledger *l, int fresh)
{
  struct stat at;
  int status = 0;
  if (stat(l->path, &at) == 0 && !S_ISREG(at.st_mode)) { /* a pipe would be waited for */
    return ledger_fail(l, l->path, "is no file, as the journal of a campaign is");
  }
  l->journal = fopen(l->path, "r+");
  if (!l->journal && errno != ENOENT) {
    return ledger_fail(l, l->path, strerror(errno));
  }
  status = l->journal ? ledger_lock(l) : 0;
  if (!status && l->journal && !fresh) {
    status = ledger_read_head(l);
    if (status != 1) {
      return status;
    }
    fprintf(stderr, "%s: %s: ends before its first run, with which the campaign begins\n", l->program, l->path);
    status = 0;
  }
  return status ? status : ledger_renew(l);
}

/* Opens the journal, begins one if there is none, takes over what is done; a status of main. */
static int ledger_open(ledger *l, const char *path, int fresh)
{
  int status;
  l->path = path;
  ledger_make_head(l);
  l->status = calloc((size_t)l->c->runs, 1);
  l->message = calloc((size_t)l->c->runs, sizeof *l->message);
  l->measured = calloc((size_t)l->c->runs, ((size_t)l->n_measure + 1) * sizeof *l->measured);
  if (!l->status || !l->message || !l->measured) {
    return ledger_fail(l, "runs", "no memory for that many");
  }
  status = ledger_find(l, fresh);
  status = status ? status : ledger_read_rows(l);
  l->began = l->said = clock_ns();
  l->on_terminal = isatty(STDERR_FILENO);
  return status;
}

/* Runs that failed count as not done. */
static void ledger_retry(ledger *l)
{
  for (int run = 0; run < l->c->runs; run++) {
    if (l->status[run] > ROW_OK) {
      l->status[run] = ROW_NONE;
      l->done--;
      l->failed--;
      l->found--;
    }
  }
}

/* ---- the work */

/* The next run that nobody has, -1 when there is none. */
static int ledger_next(ledger *l)
{
  while (l->next < l->c->runs) {
    const int run = l->next++;
    if (l->status[run] == ROW_NONE) {
      l->status[run] = ROW_GIVEN;
      return run;
    }
  }
  return -1;
}

/* A run that was given away and will not come back. */
static void ledger_return(ledger *l, int run)
{
  l->status[run] = ROW_NONE;
  l->next = run < l->next ? run : l->next;
}

/* On a terminal a line that is written over, else one every 10 s. */
static void ledger_progress(ledger *l)
{
  const double now = clock_ns(), seconds = (now - l->began) / 1e9;
  const double rate = (l->done - l->found) / seconds;
  const int all = l->done == l->c->runs;
  if (l->quiet || (now - l->said < (l->on_terminal ? 0.2e9 : 10e9) && !all)) {
    return;
  }
  l->said = now;
  fprintf(stderr, "%s%s: %d of %d runs, %d failed, %.4g runs/s, %.0f s %s%s", l->on_terminal ? "\r" : "", l->program,
          l->done, l->c->runs, l->failed, rate, all ? seconds : (l->c->runs - l->done) / rate, all ? "in all" : "to go",
          l->on_terminal && !all ? "   " : "\n");
}

/* A run is done: 0, or a status of main. */
static int ledger_add(ledger *l, campaign_row *row)
{
  for (char *p = row->message; *p; p++) {
    *p = isprint((unsigned char)*p) ? *p : ' ';
  }
  if (row->status < ROW_CRASHED && row->inputs != case_inputs(l->c, l->scene, row->run)) {
    ledger_return(l, row->run);
    return ledger_fail(l, l->c->scene, "or the campaign is not what it was at the beginning");
  }
  ledger_keep(l, row->run, row->status, row->measured, row->message);
  ledger_write_row(l, row->run);
  if (fflush(l->journal) != 0) {
    return ledger_fail(l, l->path, strerror(errno));
  }
  ledger_progress(l);
  return 0;
}
#endif
