/* fmu_xml.h - the model description of an FMU, FMI 2.0 and 3.0, and its page of documentation, from the table of
   fmu_variables.h. Names are C identifiers and need no escapes; a scene's titles, names of units and of files do. */
#ifndef FMU_XML_H
#define FMU_XML_H
#include "fmu_variables.h"
#include <stdio.h>

typedef struct fmu_export {
  int fmi; /* 2, 3 */
  int is_static, is_exact, has_events;
  double step;
  const char *name, *platform;
  char token[48];
  const fmu_parts *parts; /* of the body */
  const fb_body *body;    /* NULL: a scene.. */
  const char *title;      /* ..with this title.. */
  double stop;            /* ..and duration [s] */
  char node[FB_MAX_NODES][TEXT_NAME + 8];
  int n;
  fmu_variable list[FMU_MAX_VARIABLES];
} fmu_export;

static const char *const fmu_roles[] = {"independent", "input", "output", "parameter"};
static const char *const fmu_true[] = {"false", "true"};

static void fmu_write_text(FILE *out, const char *text)
{
  for (const char *c = text; *c; c++) {
    const char *const escape = *c == '&' ? "&amp;" : *c == '<' ? "&lt;" : *c == '>' ? "&gt;" : "&quot;";
    if (strchr("&<>\"", *c)) {
      fputs(escape, out);
    } else {
      fputc(*c, out);
    }
  }
}

/* A product such as N.m or rad/s2 in base units; with another name in it, as sqrt(kg) or lb, there are none. */
static void fmu_write_unit(FILE *out, const char *unit)
{
  static const struct {
    const char *name;
    int kg, m, s, rad;
  } known[] = {{"m", 0, 1, 0, 0},  {"kg", 1, 0, 0, 0}, {"s", 0, 0, 1, 0},  {"rad", 0, 0, 0, 1},
               {"N", 1, 1, -2, 0}, {"J", 1, 2, -2, 0}, {"W", 1, 2, -3, 0}, {"1", 0, 0, 0, 0}};
  static const char *const names[] = {"kg", "m", "s", "rad"};
  int sum[4] = {0, 0, 0, 0}, all = 1, sign = 1;
  for (const char *c = unit; *c;) {
    const size_t whole = strcspn(c, "./"), n = *c == '1' ? 1 : strcspn(c, "./0123456789");
    const int power = sign * (whole > n ? atoi(c + n) : 1);
    int k = 0;
    while (k < 8 && (strlen(known[k].name) != n || strncmp(known[k].name, c, n) != 0)) {
      k++;
    }
    all = all && k < 8;
    for (int i = 0; i < 4 && all; i++) {
      const int parts[] = {known[k].kg, known[k].m, known[k].s, known[k].rad};
      sum[i] += power * parts[i];
    }
    c += whole;
    sign = *c == '/' ? -1 : 1;
    c += *c != 0;
  }
  fputs("    <Unit name=\"", out);
  fmu_write_text(out, unit);
  fputs(all ? "\"><BaseUnit" : "\"/>\n", out);
  for (int i = 0; i < 4 && all; i++) {
    if (sum[i] != 0) {
      fprintf(out, " %s=\"%d\"", names[i], sum[i]);
    }
  }
  fputs(all ? "/></Unit>\n" : "", out);
}

/* Each unit of the variables once. */
static void fmu_write_units(FILE *out, const fmu_export *e)
{
  for (int k = 0; k < e->n; k++) {
    const char *const unit = fmu_unit(&e->list[k]);
    int first = unit != NULL;
    for (int i = 0; i < k && first; i++) {
      const char *const other = fmu_unit(&e->list[i]);
      first = !other || strcmp(other, unit) != 0;
    }
    if (first) {
      fmu_write_unit(out, unit);
    }
  }
}

static void fmu_write_name(FILE *out, const fmu_export *e, const fmu_variable *v)
{
  char name[FMU_NAME];
  fmu_name(name, v, e->node[v->node < FB_MAX_NODES ? v->node : 0]);
  fputs(name, out);
}

/* Start values of elements i to end. */
static void fmu_write_start(FILE *out, const fmu_export *e, const fmu_variable *v, int i, int end)
{
  const fmu_role role = fmu_rows[v->kind].role;
  if (role == FMU_INPUT || role == FMU_PARAMETER) {
    fputs(" start=\"", out);
    for (int k = i; k < end; k++) {
      fprintf(out, "%s%.17g", k > i ? " " : "", fmu_start(e->body, v, k, e->step));
    }
    fputs("\"", out);
  }
}

static void fmu_write_attributes(FILE *out, const fmu_variable *v, int reference)
{
  const fmu_role role = fmu_rows[v->kind].role;
  fprintf(out, " valueReference=\"%d\" causality=\"%s\" variability=\"%s\"", reference, fmu_roles[role],
          role == FMU_PARAMETER ? "fixed" : "continuous");
  if (role == FMU_PARAMETER || role == FMU_OUTPUT) {
    fprintf(out, " initial=\"%s\"", role == FMU_PARAMETER ? "exact" : "calculated");
  }
  fprintf(out, " description=\"%s\"", fmu_what(v));
}

/* The attributes of the type, with the start of elements i to end. */
static void fmu_write_type(FILE *out, const fmu_export *e, const fmu_variable *v, int i, int end)
{
  if (fmu_unit(v)) {
    fputs(" unit=\"", out);
    fmu_write_text(out, fmu_unit(v));
    fputs("\"", out);
  }
  if (v->kind == FMU_INTEGRATOR) {
    fputs(" declaredType=\"Integrator\"", out);
  } else if (v->kind == FMU_EFFECTS) {
    fputs(" declaredType=\"Effects\"", out);
  } else if (fmu_is_factor(v->kind)) {
    fprintf(out, " min=\"%g\" max=\"%g\"", FMU_FACTOR_LEAST, FMU_FACTOR_MOST);
  }
  if (v->kind == FMU_STEP || v->kind == FMU_DAMPING || v->kind == FMU_SCENE_STEP) {
    fputs(" min=\"0\"", out);
  }
  fmu_write_start(out, e, v, i, end);
}

static void fmu_write_variable2(FILE *out, const fmu_export *e, const fmu_variable *v)
{
  for (int i = 0; i < v->count; i++) {
    fputs("    <ScalarVariable name=\"", out);
    fmu_write_name(out, e, v);
    if (v->count > 1 || fmu_rows[v->kind].count == FMU_MODES) {
      fprintf(out, "[%d]", i + 1);
    }
    fputs("\"", out);
    fmu_write_attributes(out, v, v->first + i);
    fprintf(out, "><%s", fmu_is_choice(v->kind) ? "Enumeration" : "Real");
    fmu_write_type(out, e, v, i, i + 1);
    fputs("/></ScalarVariable>\n", out);
  }
}

static void fmu_write_variable3(FILE *out, const fmu_export *e, const fmu_variable *v)
{
  const char *const type = fmu_is_choice(v->kind) ? "Enumeration" : "Float64";
  fprintf(out, "    <%s name=\"", type);
  fmu_write_name(out, e, v);
  fputs("\"", out);
  fmu_write_attributes(out, v, v->first);
  fmu_write_type(out, e, v, 0, v->count);
  if (v->count > 1 || fmu_rows[v->kind].count == FMU_MODES) {
    fprintf(out, "><Dimension start=\"%d\"/></%s>\n", v->count, type);
  } else {
    fputs("/>\n", out);
  }
}

/* References of the inputs on which an output depends directly; FMI 2: indexes, which are references plus 1, each. */
static void fmu_write_dependencies(FILE *out, const fmu_export *e, const fmu_variable *v)
{
  const char *between = "";
  fputs(" dependencies=\"", out);
  for (int k = 0; k < e->n; k++) {
    const fmu_variable *const input = &e->list[k];
    const int pulls = fmu_rows[input->kind].role == FMU_INPUT && fmu_follows(v, input);
    for (int i = 0; i < (e->fmi == 2 ? input->count : 1) && pulls; i++) {
      fprintf(out, "%s%d", between, input->first + i + (e->fmi == 2));
      between = " ";
    }
  }
  fputs("\"", out);
}

/* All outputs as `element`, with what they depend on at communication points or, initial, on all that is known. */
static void fmu_write_unknowns(FILE *out, const fmu_export *e, const char *element, int initial)
{
  for (int k = 0; k < e->n; k++) {
    const fmu_variable *const v = &e->list[k];
    const int count = fmu_rows[v->kind].role != FMU_OUTPUT ? 0 : e->fmi == 2 ? v->count : 1;
    for (int i = 0; i < count; i++) {
      fprintf(out, "    <%s %s=\"%d\"", element, e->fmi == 2 ? "index" : "valueReference",
              v->first + i + (e->fmi == 2));
      if (!initial) {
        fmu_write_dependencies(out, e, v);
      }
      fputs("/>\n", out);
    }
  }
}

static void fmu_write_structure(FILE *out, const fmu_export *e)
{
  fputs("  <ModelStructure>\n", out);
  fputs(e->fmi == 2 ? "    <Outputs>\n" : "", out);
  fmu_write_unknowns(out, e, e->fmi == 2 ? "Unknown" : "Output", 0);
  fputs(e->fmi == 2 ? "    </Outputs>\n    <InitialUnknowns>\n" : "", out);
  fmu_write_unknowns(out, e, e->fmi == 2 ? "Unknown" : "InitialUnknown", 1);
  fputs(e->fmi == 2 ? "    </InitialUnknowns>\n" : "", out);
  fputs("  </ModelStructure>\n", out);
}

static void fmu_write_kind(FILE *out, const fmu_export *e)
{
  const int two = e->fmi == 2;
  fprintf(out,
          "  <CoSimulation modelIdentifier=\"%s\" canHandleVariableCommunicationStepSize=\"true\"\n"
          "    canBeInstantiatedOnlyOncePerProcess=\"%s\" canGetAndSetFMU%s=\"true\" canSerializeFMU%s=\"true\"\n"
          "    maxOutputDerivativeOrder=\"%d\" providesDirectionalDerivative%s=\"true\"",
          e->name, fmu_true[e->is_static], two ? "state" : "State", two ? "state" : "State", !e->is_exact,
          two ? "" : "s");
  if (two) {
    fprintf(out,
            " canNotUseMemoryManagementFunctions=\"%s\">\n"
            "    <SourceFiles><File name=\"%sfmu2.c\"/></SourceFiles>\n  </CoSimulation>\n",
            fmu_true[e->is_static], e->body ? "" : "examples/fmu/");
  } else {
    fprintf(out, " providesAdjointDerivatives=\"true\"\n    hasEventMode=\"%s\" mightReturnEarlyFromDoStep=\"%s\"/>\n",
            fmu_true[e->has_events], fmu_true[e->has_events]);
  }
}

/* An enumeration: of settings.effects those that the body has. */
static void fmu_write_choices(FILE *out, const fmu_export *e, fmu_kind kind)
{
  static const char *const name[][FMU_EFFECTS_CHOICES] = {{"rk4", "midpoint", "sdirk", "exponential"},
                                                          {"as_described", "linear", "spin", "full"}};
  const int two = e->fmi == 2, effects = kind == FMU_EFFECTS;
  fprintf(out, two ? "    <SimpleType name=\"%s\"><Enumeration>\n" : "    <EnumerationType name=\"%s\">\n",
          effects ? "Effects" : "Integrator");
  for (int k = 1; k <= fmu_choices(kind); k++) {
    if (!effects || fmu_has_effects(e->body, k)) {
      fprintf(out, "      <Item name=\"%s\" value=\"%d\"/>\n", name[effects][k - 1], k);
    }
  }
  fputs(two ? "    </Enumeration></SimpleType>\n" : "    </EnumerationType>\n", out);
}

static void fmu_write_types(FILE *out, const fmu_export *e)
{
  fputs("  <UnitDefinitions>\n", out);
  fmu_write_units(out, e);
  fputs("  </UnitDefinitions>\n", out);
  if (!e->body) {
    return;
  }
  fputs("  <TypeDefinitions>\n", out);
  for (int k = 0; k < e->n; k++) {
    if (fmu_is_choice(e->list[k].kind)) {
      fmu_write_choices(out, e, e->list[k].kind);
    }
  }
  fputs("  </TypeDefinitions>\n", out);
}

static void fmu_write_subject(FILE *out, const fmu_export *e)
{
  if (e->body) {
    fprintf(out, "a flexible body of %d modes and %d nodes, %.9g kg", e->body->n, e->body->n_node,
            (double)e->body->mass);
  } else {
    fmu_write_text(out, e->title);
  }
}

/* modelDescription.xml */
static void fmu_write_description(FILE *out, const fmu_export *e)
{
  const int two = e->fmi == 2;
  fprintf(out,
          "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"%d.0\" modelName=\"%s\"\n"
          "  %s=\"%s\"\n  description=\"",
          e->fmi, e->name, two ? "guid" : "instantiationToken", e->token);
  fmu_write_subject(out, e);
  fprintf(out, "\"\n  generationTool=\"flexbeam %s\" variableNamingConvention=\"structured\">\n", FB_VERSION);
  fmu_write_kind(out, e);
  fmu_write_types(out, e);
  fputs("  <LogCategories>\n    <Category name=\"logStatusError\" description=\"what was refused, and why\"/>\n"
        "  </LogCategories>\n",
        out);
  fprintf(out, "  <DefaultExperiment startTime=\"0\" stopTime=\"%.17g\" stepSize=\"%.17g\"/>\n  <ModelVariables>\n",
          e->body ? 10 : e->stop, !e->body || e->step >= 0.01 ? e->step : 0.01);
  for (int k = 0; k < e->n; k++) {
    (two ? fmu_write_variable2 : fmu_write_variable3)(out, e, &e->list[k]);
  }
  fputs("  </ModelVariables>\n", out);
  fmu_write_structure(out, e);
  fputs("</fmiModelDescription>\n", out);
}

/* sources/buildDescription.xml of FMI 3 */
static void fmu_write_build(FILE *out, const fmu_export *e)
{
  fprintf(out,
          "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiBuildDescription fmiVersion=\"3.0\">\n"
          "  <BuildConfiguration modelIdentifier=\"%s\">\n    <SourceFileSet language=\"C99\">\n"
          "      <SourceFile name=\"%sfmu3.c\"/>\n    </SourceFileSet>\n    <Library name=\"m\"/>\n"
          "  </BuildConfiguration>\n</fmiBuildDescription>\n",
          e->name, e->body ? "" : "examples/fmu/");
}

/* documentation/index.html */
static void fmu_write_page(FILE *out, const fmu_export *e)
{
  fprintf(out,
          "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>%s</title></head><body>\n"
          "<h1>%s</h1>\n<p>",
          e->name, e->name);
  fmu_write_subject(out, e);
  fprintf(out,
          ": a %s as a co-simulation FMU of FMI %d.0, exported by flexbeam %s.</p>\n"
          "<p>Inputs are held over a communication step. %s A step that the integrator refuses leaves the state as it "
          "was, and is answered by Discard with the reason in the log.</p>\n"
          "<p>%s</p>\n"
          "<table>\n<tr><th>variable</th><th>numbers</th><th>causality</th><th>unit</th><th>start</th>"
          "<th>meaning</th></tr>\n",
          e->body ? "body" : "scene", e->fmi, FB_VERSION,
          e->body ? "It is made of internal steps: as many of settings.step as go into it, or, where that is no whole "
                    "number, of equal ones that are not longer."
                  : "They add to what the scene says: left at zero, it moves as the scene does.",
          e->body ? "Vectors are listed once. The number of modes and their shapes are part of the model: another "
                    "description is another FMU."
                  : "The scene, with the files that it names, is among the resources.");
  for (int k = 0; k < e->n; k++) {
    const fmu_variable *const v = &e->list[k];
    const fmu_row *const row = &fmu_rows[v->kind];
    fputs("<tr><td>", out);
    fmu_write_name(out, e, v);
    fprintf(out, "</td><td>%d</td><td>%s</td><td>", v->count, fmu_roles[row->role]);
    fmu_write_text(out, fmu_unit(v) ? fmu_unit(v) : "");
    fputs("</td><td>", out);
    for (int i = 0; i < v->count && (row->role == FMU_INPUT || row->role == FMU_PARAMETER); i++) {
      fprintf(out, "%s%.9g", i ? " " : "", fmu_start(e->body, v, i, e->step));
    }
    fprintf(out, "</td><td>%s</td></tr>\n", fmu_what(v));
  }
  fputs("</table>\n</body></html>\n", out);
}
#endif
