/* The mutant of the environment variable MUTANT, 0 for none; the functions with mutants that were called go to the file
   REACHED. */
#include <stdio.h>
#include <stdlib.h>

static int fbi_mutant;
static const char *fbi_reached[9999];

__attribute__((constructor)) static void fbi_mutant_choose(void)
{
  fbi_mutant = getenv("MUTANT") ? atoi(getenv("MUTANT")) : 0;
}

__attribute__((destructor)) static void fbi_reached_print(void)
{
  FILE *const file = getenv("REACHED") ? fopen(getenv("REACHED"), "w") : NULL;
  for (int i = 0; file && i < (int)(sizeof fbi_reached / sizeof fbi_reached[0]); i++) {
    if (fbi_reached[i]) {
      fprintf(file, "%s\n", fbi_reached[i]);
    }
  }
  if (file) {
    fclose(file);
  }
}
