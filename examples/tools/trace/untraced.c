/* untraced.c - in place of trace.cpp where there is no compiler of C++. */
#include "trace.h"

int trace_write(FILE *out, const trace_choice *choice, const trace_model *model, char text[400])
{
  (void)out, (void)choice, (void)model;
  snprintf(text, 400, "this program was made without a compiler of C++: install g++ and make it again");
  return 1;
}
