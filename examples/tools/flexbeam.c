/* flexbeam - the command line: `flexbeam WORD ...` hands what follows to the word, whose exit status is its own.
   Exit: 2 for no word or an unknown one. */
#include "words.h"
#include "../common/output.h"

typedef struct word {
  const char *name, *what;
  int (*main)(int argc, char **argv);
} word;

static const word words[] = {
#define WORD_ROW(name, what) {#name, what, name##_main},
    WORDS(WORD_ROW)
#undef WORD_ROW
};
#define WORD_COUNT ((int)(sizeof words / sizeof words[0]))

static void tell(FILE *to)
{
  fputs("usage: flexbeam WORD ..., flexbeam WORD --help\n", to);
  for (int k = 0; k < WORD_COUNT; k++) {
    fprintf(to, "  %-10s %s\n", words[k].name, words[k].what);
  }
}

int main(int argc, char **argv)
{
  for (int k = 0; k < WORD_COUNT && argc > 1; k++) {
    if (strcmp(argv[1], words[k].name) == 0) {
      return words[k].main(argc - 1, argv + 1);
    }
  }
  if (argc > 1 && strcmp(argv[1], "--help") == 0) {
    output_begin("flexbeam");
    tell(stdout);
    return 0;
  }
  if (argc > 1) {
    fprintf(stderr, "flexbeam: unknown word: %s\n", argv[1]);
  }
  tell(stderr);
  return 2;
}
