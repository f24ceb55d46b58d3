/* csv.h - columns of a CSV file: # begins a line of comment, the first other line names the columns. Commas or, where
   the names have none, semicolons stand between entries, which may be quoted. Include text.h first. */
#ifndef CSV_H
#define CSV_H

#define CSV_LINE 16384

typedef struct csv_file {
  FILE *file;
  int line;
  char between; /* , or ; */
  char buffer[CSV_LINE];
} csv_file;

/* The next line that is no comment; 0 at the end, or after a complaint. */
static int csv_line(csv_file *f, text_file *t, const char *path)
{
  while (fgets(f->buffer, (int)sizeof f->buffer, f->file)) {
    const size_t n = strlen(f->buffer);
    f->line++;
    if (f->line == 1 && strncmp(f->buffer, "\xEF\xBB\xBF", 3) == 0) { /* byte order mark */
      memmove(f->buffer, f->buffer + 3, n - 2);
    }
    if (!strchr(f->buffer, '\n') && !feof(f->file)) {
      text_fail(t, n + 1 == sizeof f->buffer ? "%s:%d: the line is longer than %d characters" : "%s:%d: is no text",
                path, f->line, CSV_LINE - 2);
      return 0;
    }
    if (f->buffer[0] != '#' && f->buffer[strspn(f->buffer, " \r\n")]) {
      return 1;
    }
  }
  return 0;
}

/* Where the entry ends that begins there: quotes may hold what stands between entries. */
static const char *csv_end(const csv_file *f, const char *at)
{
  int quoted = 0;
  while (*at && *at != '\r' && *at != '\n' && (quoted || *at != f->between)) {
    quoted ^= *at++ == '"';
  }
  return at;
}

/* Entry k of the line, without quotes and blanks around it; NULL where there is none. */
static const char *csv_entry(const csv_file *f, int k, char entry[64])
{
  const char *at = f->buffer, *end = csv_end(f, at);
  size_t n;
  for (int i = 0; i < k; i++) {
    if (*end != f->between) {
      return NULL;
    }
    at = end + 1;
    end = csv_end(f, at);
  }
  at += strspn(at, " \"");
  n = end > at ? (size_t)(end - at) : 0;
  while (n > 0 && (at[n - 1] == ' ' || at[n - 1] == '"')) {
    n--;
  }
  n = n < 63 ? n : 63;
  memcpy(entry, at, n);
  entry[n] = 0;
  return entry;
}

/* Column of that name in the header line, which may have a unit behind it in brackets; -1: none. */
static int csv_column(const csv_file *f, const char *name)
{
  char entry[64];
  for (int k = 0; csv_entry(f, k, entry); k++) {
    entry[strcspn(entry, " [")] = 0;
    if (strcmp(entry, name) == 0) {
      return k;
    }
  }
  return -1;
}

/* Opens the file and finds its columns by name; complaints go to t. */
static int csv_open(csv_file *f, text_file *t, const char *path, const char *const *name, int *column, int n)
{
  f->line = 0;
  f->file = fopen(path, "r");
  if (!f->file) {
    text_fail(t, "%s: %s", path, strerror(errno));
    return 0;
  }
  if (!csv_line(f, t, path)) {
    text_fail(t, "%s is empty", path);
    return 0;
  }
  f->between = ',';
  f->between = *csv_end(f, f->buffer) == ',' ? ',' : ';';
  for (int k = 0; k < n; k++) {
    column[k] = csv_column(f, name[k]);
    if (column[k] < 0) {
      text_fail(t, "%s has no column %s", path, name[k]);
    }
  }
  return !t->failed;
}

/* The numbers of the next row; 0 at the end. */
static int csv_row(csv_file *f, text_file *t, const char *path, double *x, const int *column, int n)
{
  char entry[64], *end;
  if (!csv_line(f, t, path)) {
    return 0;
  }
  for (int k = 0; k < n; k++) {
    const char *const text = csv_entry(f, column[k], entry);
    x[k] = text ? strtod(text, &end) : 0;
    if (!text || end == text || *end || !isfinite(x[k])) {
      text_fail(t, "%s:%d: column %d is not a number: %s", path, f->line, column[k] + 1, text ? text : "missing");
      return 0;
    }
  }
  return 1;
}
#endif
