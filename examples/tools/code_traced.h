/* code_traced.h - what stands around the functions that a trace writes: those of one model, of all lanes at once where it has
   any. Include code.h or code_tree.h first. */
#ifndef CODE_TRACED_H
#define CODE_TRACED_H
#include "code_lanes.h"
#include "trace/trace.h"

/* The functions whose declarations stand above, to the end of the file; types: writes those of a state and what acts. 0, or 1
   with why in text. */
static int code_write_traced(const code *w, trace_choice choice, const trace_model *of, int lanes,
                             void (*types)(const code *), char text[400])
{
  int (*const trace)(FILE *, const trace_choice *, const trace_model *, char[400]) =
      w->single ? trace_step_single : trace_step;
  int bad;
  fputs("\n", w->out);
  bad = trace(w->out, &choice, of, text);
  if (lanes && !bad) {
    const code wide = code_lanes_begin(w);
    code_lanes_template(w, code_lanes_angles);
    code_lanes_template(w, code_lanes_traced);
    types(&wide);
    choice.wide = 1;
    bad = trace(w->out, &choice, of, text);
    code_lanes_end(w);
  }
  fputs("#endif\n", w->out);
  return bad;
}
#endif
