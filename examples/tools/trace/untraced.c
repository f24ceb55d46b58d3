/* untraced.c - in place of trace.cpp where there is no compiler of C++. */
#include "trace.h"

static int untraced(char text[400])
{
  snprintf(text, 400, "this program was made without a compiler of C++: install g++ and make it again");
  return 1;
}

int trace_write(FILE *out, const trace_choice *choice, const trace_model *model, char text[400])
{
  (void)out, (void)choice, (void)model;
  return untraced(text);
}

int trace_step(FILE *out, const trace_choice *choice, const trace_model *model, char text[400])
{
  (void)out, (void)choice, (void)model;
  return untraced(text);
}

int trace_step_single(FILE *out, const trace_choice *choice, const trace_model *model, char text[400])
{
  (void)out, (void)choice, (void)model;
  return untraced(text);
}

int trace_places(const trace_choice *choice, const trace_model *model)
{
  (void)choice, (void)model;
  return 1;
}

int trace_places_single(const trace_choice *choice, const trace_model *model)
{
  (void)choice, (void)model;
  return 1;
}
