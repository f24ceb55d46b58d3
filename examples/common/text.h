/* text.h - reads text files word by word; every complaint names file and line, and the blocks around it where one of
   them is not ended. Comments run from # to the end of a line. Commas count as blanks; between digits, where they may be decimal ones, only in
   tables that have them (text_file.table). Where names are given, $NAME stands for a number, also in products such as
   -2*$NAME. */
#ifndef TEXT_H
#define TEXT_H
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TEXT_MESSAGE 768 /* characters of a complaint */
#define TEXT_NAME 32     /* of a name, which holds: */
#define TEXT_NAME_CHARACTERS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_"

typedef struct text_named { /* a number with a name */
  char name[TEXT_NAME];
  double value;
  int line, used; /* where it is given; has something taken it? */
} text_named;

#define TEXT_WORDS 64

typedef struct text_words { /* words that were there, and the line of the first of each */
  int n, line[TEXT_WORDS];
  char word[TEXT_WORDS][TEXT_NAME];
} text_words;

#define TEXT_BLOCKS 4 /* within each other: body, beam, stations are 3 */

typedef struct text_fault { /* what a complaint is about; line 0, empty: about none */
  char file[512], word[64];
  int line;
} text_fault;

typedef struct text_file {
  FILE *file;
  const char *text; /* what is left of a text in memory; NULL: the file is read */
  const char *program, *name;
  int line, failed;
  int table;           /* 1: 0,1 are two numbers */
  int begins, n_block; /* 1: the line begins a block, which may be none of these yet */
  struct {             /* that are not ended yet: kind, name (empty: none) and line of the first line */
    const char *kind, *name;
    int line;
  } block[TEXT_BLOCKS];
  char buffer[2048], *at; /* what is left of the line */
  const char *word;       /* the last one that was taken, and.. */
  int word_line;          /* ..its line */
  char *message;          /* TEXT_MESSAGE characters for a complaint; NULL: it goes to stderr */
  text_fault *fault;      /* NULL: nobody asks */
  text_named *named;
  int n_named;
} text_file;

/* 1 if a line begins a block (one of these words, and a name or a column, but not `like` another; or state_space alone), -1 if
   it ends one. */
static inline int text_begins(const char *line)
{
  static const char *const begin[] = {"body", "joint",     "loop",     "spring",     "rotor",
                                      "beam", "component", "stations", "allocation", "control"};
  char word[16] = "", name[64] = "", like[6] = "";
  const int words = sscanf(line, "%15s %63s %5s", word, name, like);
  for (int k = 0; k < (int)(sizeof begin / sizeof *begin) && words > 1 && strcmp(like, "like") != 0; k++) {
    if (strcmp(word, begin[k]) == 0) {
      return isalpha((unsigned char)name[0]) || name[0] == '_';
    }
  }
  return words == 1 && strcmp(word, "state_space") == 0 ? 1 : -(strcmp(word, "end") == 0);
}

/* As fgets. */
static inline char *text_gets(text_file *t, char *line, size_t size)
{
  size_t n;
  if (!t->text) {
    return fgets(line, (int)size, t->file);
  }
  n = strcspn(t->text, "\n");
  n += t->text[n] == '\n';
  n = n < size - 1 ? n : size - 1;
  memcpy(line, t->text, n);
  line[n] = 0;
  t->text += n;
  return n > 0 ? line : NULL;
}

/* Has the rest of the file, which this reads, fewer lines `end` than its blocks and those around it want? */
static inline int text_lacks_end(text_file *t)
{
  char line[sizeof t->buffer];
  int open = t->n_block + t->begins;
  while (t->n_block > 0 && text_gets(t, line, sizeof line)) {
    open += text_begins(line);
  }
  return t->n_block > 0 && open > 0;
}

/* Appends the blocks around it, the innermost first, if an `end` is missing: what follows was taken for their lines. */
static inline void text_tell_blocks(text_file *t, char message[TEXT_MESSAGE])
{
  const int lacks = text_lacks_end(t);
  for (int k = t->n_block; lacks && k-- > 0;) {
    const size_t n = strlen(message);
    snprintf(message + n, TEXT_MESSAGE - n, "%s%s%s%s of line %d%s", k + 1 == t->n_block ? " (inside " : ", ",
             t->block[k].kind, t->block[k].name[0] ? " " : "", t->block[k].name, t->block[k].line,
             k == 0 ? ": a line `end` is missing)" : "");
  }
}

static inline void text_blame(text_fault *fault, const char *file, int line, const char *word)
{
  snprintf(fault->file, sizeof fault->file, "%s", file);
  snprintf(fault->word, sizeof fault->word, "%s", word);
  fault->line = line;
}

/* Says what is wrong, once; the reader then finds no more words. */
static inline void text_fail(text_file *t, const char *format, ...)
{
  char message[TEXT_MESSAGE];
  int n;
  va_list list;
  if (!t->failed) {
    n = snprintf(message, sizeof message, t->line > 0 ? "%.400s:%d: " : "%.400s: ", t->name, t->line);
    va_start(list, format);
    vsnprintf(message + n, sizeof message - (size_t)n, format, list);
    va_end(list);
    if (t->fault) {
      text_blame(t->fault, t->name, t->line, t->word && t->word_line == t->line ? t->word : "");
    }
    text_tell_blocks(t, message);
    if (t->message) {
      memcpy(t->message, message, sizeof message);
    } else {
      fprintf(stderr, "%s: %s\n", t->program, message);
    }
  }
  t->failed = 1;
}

/* Of a text in memory, which is called `name`; NULL: of the file of that name. 0 when that cannot be read, of which nothing
   is said. */
static inline int text_try_of(text_file *t, const char *program, const char *name, const char *text)
{
  memset(t, 0, sizeof *t);
  t->program = program;
  t->name = name;
  t->at = t->buffer;
  t->text = text;
  t->file = text ? NULL : fopen(name, "r");
  return text || t->file;
}

static inline int text_try(text_file *t, const char *program, const char *name)
{
  return text_try_of(t, program, name, NULL);
}

/* 0 when the file cannot be read. */
static inline int text_open(text_file *t, const char *program, const char *name)
{
  if (!text_try(t, program, name)) {
    text_fail(t, "%s", strerror(errno));
  }
  return t->file != NULL;
}

/* The name of a file that another one names, from that one's folder. */
static inline void text_beside(char path[512], const char *from, const char *name)
{
  const char *const slash = strrchr(from, '/');
  snprintf(path, 512, "%.*s%s", name[0] == '/' || !slash ? 0 : (int)(slash - from + 1), from, name);
}

static inline void text_close(text_file *t)
{
  if (t->file) {
    fclose(t->file);
  }
  t->file = NULL;
}

/* The next line as it stands; 0 at the end. */
static inline int text_raw_line(text_file *t)
{
  t->at = t->buffer;
  t->buffer[0] = 0;
  if (t->failed || !text_gets(t, t->buffer, sizeof t->buffer)) {
    if (!t->failed && t->file && ferror(t->file)) {
      text_fail(t, "cannot be read");
    }
    return 0;
  }
  t->line++;
  if (t->line == 1 && strncmp(t->buffer, "\xEF\xBB\xBF", 3) == 0) { /* byte order mark */
    memmove(t->buffer, t->buffer + 3, strlen(t->buffer) - 2);
  }
  if (!strchr(t->buffer, '\n') && !(t->text ? !*t->text : feof(t->file))) {
    text_fail(t, strlen(t->buffer) + 1 == sizeof t->buffer ? "the line is longer than %d characters" : "is no text",
              (int)sizeof t->buffer - 2);
    return 0;
  }
  return 1;
}

/* The next line that holds a word; 0 at the end. */
static inline int text_line(text_file *t)
{
  while (text_raw_line(t)) {
    char *comment = strchr(t->buffer, '#');
    if (comment) {
      *comment = 0;
    }
    t->begins = text_begins(t->buffer) > 0;
    for (char *c = t->buffer; *c; c++) {
      const int within = c > t->buffer && isdigit((unsigned char)c[-1]) && isdigit((unsigned char)c[1]);
      *c = (*c == ',' && (t->table || !within)) || *c == '\t' || *c == '\r' || *c == '\n' ? ' ' : *c;
    }
    if (t->buffer[strspn(t->buffer, " ")]) {
      return 1;
    }
  }
  return 0;
}

/* The next word of the line, NULL if there is none. */
static inline const char *text_word(text_file *t)
{
  char *word;
  t->at += strspn(t->at, " ");
  word = t->at;
  if (t->failed || !*word) {
    return NULL;
  }
  t->at += strcspn(t->at, " ");
  if (*t->at) {
    *t->at++ = 0;
  }
  t->word = word;
  t->word_line = t->line;
  return word;
}

/* A factor at *at, which moves behind it: a number, $NAME or -$NAME. 0 where there is none. */
static inline int text_factor(text_file *t, const char **at, double *x)
{
  const char *const start = *at, *name = start + (*start == '-');
  char *end;
  if (*name != '$') {
    *x = strtod(start, &end);
    *at = end;
    return end != start;
  }
  name++;
  *at = name + strspn(name, TEXT_NAME_CHARACTERS);
  for (int k = 0; k < t->n_named; k++) {
    if (strlen(t->named[k].name) == (size_t)(*at - name) &&
        strncmp(t->named[k].name, name, strlen(t->named[k].name)) == 0) {
      t->named[k].used = 1;
      *x = *start == '-' ? -t->named[k].value : t->named[k].value;
      return 1;
    }
  }
  text_fail(t, "no parameter has the name %.*s", (int)(*at - name), name);
  return 0;
}

/* The next word as a finite number, or a product of numbers and names. */
static inline double text_number(text_file *t, const char *what)
{
  const char *const word = text_word(t), *at = word;
  double x = 0, factor;
  if (!word) {
    text_fail(t, "%s is missing", what);
    return 0;
  }
  if (text_factor(t, &at, &x)) {
    while (*at == '*' || *at == '/') {
      const int over = *at++ == '/';
      x = !text_factor(t, &at, &factor) ? (double)NAN : over ? x / factor : x * factor;
    }
  }
  if (*at || at == word || !isfinite(x)) {
    text_fail(t, "%s is not a number: %s%s", what, word,
              strchr(word, ',') ? " (a decimal point, or blanks between numbers, not a comma)" : "");
    return 0;
  }
  return x;
}

/* Degrees, to radians. */
static inline double text_degrees(text_file *t, const char *what)
{
  return text_number(t, what) * 3.14159265358979324 / 180;
}

/* A whole number from least to most. */
static inline int text_whole(text_file *t, const char *what, int least, int most)
{
  const double x = text_number(t, what);
  if (!t->failed && (x != floor(x) || x < least || x > most)) {
    text_fail(t, "%s must be a whole number from %d to %d", what, least, most);
  }
  return t->failed ? least : (int)x;
}

/* 1 if the line has another word. */
static inline int text_more(text_file *t)
{
  return !t->failed && t->at[strspn(t->at, " ")];
}

/* Takes the next word if it is this one: 1. */
static inline int text_take(text_file *t, const char *word)
{
  const char *const at = t->at + strspn(t->at, " ");
  const size_t n = strlen(word);
  const int is = !t->failed && strncmp(at, word, n) == 0 && (at[n] == ' ' || !at[n]);
  if (is) {
    (void)text_word(t);
  }
  return is;
}

/* n numbers. */
static inline void text_vector(text_file *t, const char *what, double *x, int n)
{
  char which[96];
  for (int i = 0; i < n; i++) {
    snprintf(which, sizeof which, n > 1 ? "%s, number %d of %d" : "%s", what, i + 1, n);
    x[i] = text_number(t, which);
  }
}

/* Index of the next word in a list that ends with NULL; complains with the list. */
static inline int text_choice(text_file *t, const char *what, const char *const *list)
{
  const char *word = text_word(t);
  char all[512] = "";
  for (int k = 0; list[k]; k++) {
    if (word && strcmp(word, list[k]) == 0) {
      return k;
    }
    if (strlen(all) + strlen(list[k]) + 2 < sizeof all) {
      strcat(strcat(all, " "), list[k]);
    }
  }
  text_fail(t, "%s must be one of%s, is %s", what, all, word ? word : "missing");
  return 0;
}

/* The next word as a name. */
static inline void text_name(text_file *t, const char *what, char name[TEXT_NAME])
{
  const char *const word = text_word(t);
  if (!word) {
    text_fail(t, "the name of %s is missing", what);
  } else if (strlen(word) >= TEXT_NAME || !(isalpha((unsigned char)word[0]) || word[0] == '_') ||
             word[strspn(word, TEXT_NAME_CHARACTERS)]) {
    text_fail(t, "the name of %s has letters, digits and _, %d at most and no digit first: %s", what, TEXT_NAME - 1,
              word);
  } else {
    strcpy(name, word);
  }
}

/* Line of a word that was there, 0 if it was not. */
static inline int text_seen(const text_words *words, const char *word)
{
  for (int k = 0; k < words->n; k++) {
    if (strcmp(words->word[k], word) == 0) {
      return words->line[k];
    }
  }
  return 0;
}

/* Notes that a word was there. */
static inline void text_note(const text_file *t, text_words *words, const char *word)
{
  if (words->n < TEXT_WORDS && strlen(word) < TEXT_NAME && !text_seen(words, word)) { /* no other word is known */
    strcpy(words->word[words->n], word);
    words->line[words->n++] = t->line;
  }
}

/* Refuses a word that was there before. */
static inline void text_once(text_file *t, text_words *words, const char *word)
{
  if (text_seen(words, word)) {
    text_fail(t, "%s is there twice", word);
  }
  text_note(t, words, word);
}

/* Begins a block at this line; `name` must last until it ends. */
static inline void text_begin(text_file *t, const char *kind, const char *name)
{
  t->begins = 0; /* it is one of them now */
  t->block[t->n_block].kind = kind;
  t->block[t->n_block].name = name;
  t->block[t->n_block++].line = t->line;
}

#ifdef FLEXBEAM_H
static inline void text_reals(text_file *t, const char *what, fb_real *x, int n)
{
  double value[16] = {0};
  text_vector(t, what, value, n);
  for (int i = 0; i < n; i++) {
    x[i] = (fb_real)value[i];
  }
}
#endif

static inline void text_end_of_line(text_file *t)
{
  const char *word = text_word(t);
  if (word) {
    text_fail(t, "too much on the line: %s", word);
  }
}

/* The next line of the innermost block: 1; 0 and no more of it: its line `end`, or the file ends without. */
static inline int text_within(text_file *t)
{
  const int more = text_line(t), ended = text_take(t, "end");
  if (more && !ended) {
    return 1;
  }
  t->n_block--;
  if (!more) {
    text_fail(t, "%s%s%s of line %d wants a line `end`", t->block[t->n_block].kind,
              t->block[t->n_block].name[0] ? " " : "", t->block[t->n_block].name, t->block[t->n_block].line);
  }
  text_end_of_line(t);
  return 0;
}
#endif
