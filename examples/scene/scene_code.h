/* scene_code.h - writes the step of the bodies and joints of a scene as C of its own, of SDIRK where it says so, else of
   rk4: scene --code; their rates with a Jacobian: scene --jacobian. See scene.h, ../tools/code_tree.h, ../tools/trace. */
#ifndef SCENE_CODE_H
#define SCENE_CODE_H
#include "scene_run.h"
#undef I /* that of complex.h: inertia below */
#include "../tools/code_tree.h"

static const scene *scene_code_of; /* what is written */

/* How many rotors a line drives. */
static int scene_code_rotors(const scene *s)
{
  int n = 0;
  for (int k = 0; k < s->n_rotor; k++) {
    const function *const f = &s->rotor[k].f;
    n += f->kind != FUNCTION_CONSTANT || fabs(f->a) > 0;
  }
  return n;
}

/* Springs that an actuator pulls, by a line of their own or a controller; line of the first, 0: there is none. */
static int scene_code_pulls(unsigned char pulls[FB_MAX_SPRINGS], const scene *s)
{
  int line = 0;
  for (int k = s->n_spring - 1; k >= 0; k--) {
    pulls[k] = s->spring[k].pulls || s->spring[k].act >= 0;
    line = pulls[k] ? s->spring[k].line : line;
  }
  return line;
}

/* What a body has for nodes, in text. */
static void scene_code_known(char text[TEXT_MESSAGE], const scene_body *body)
{
  size_t n = (size_t)snprintf(text, TEXT_MESSAGE, body->n_node > 1 ? "it has" : "it has none");
  for (int k = 1; k < body->n_node && n < TEXT_MESSAGE / 2; k++) {
    n += (size_t)snprintf(text + n, TEXT_MESSAGE - n, body->node_name[k][0] ? "%s %d or %s" : "%s %d", k > 1 ? "," : "",
                          k, body->node_name[k]);
  }
}

/* Says what is wrong with a body or node of --loads or --sensors. */
static void scene_code_no_node(scene *s, const char *option, const char *name, const char *part, int body, int node)
{
  char known[TEXT_MESSAGE];
  if (!name[0]) {
    scene_fail(s, "%s: a name is missing; choose BODY.NODE, or BODY for its origin, with commas", option);
  } else if (body == s->n_body) {
    scene_fail(s, "%s %s%s%s: there is no body %s; choose BODY.NODE, or BODY for its origin", option, name,
               part[0] ? "." : "", part, name);
  } else if (node >= 0) {
    scene_fail(s, "%s %s%s%s: named twice; choose each node once", option, name, part[0] ? "." : "", part);
  } else {
    scene_code_known(known, &s->body[body]);
    scene_fail(s, "%s %s.%s: body %s has no such node; %s, and %s alone is its origin", option, name, part, name, known,
               name);
  }
}

/* Line of the first motor on a loop's joint, 0: there is none. */
static int scene_code_motor(const scene *s)
{
  int line = 0;
  for (int k = 0; k < s->n_drive && line == 0; k++) {
    line = s->drive[k].kind == SCENE_MOTOR && s->joint[s->drive[k].joint].loop ? s->drive[k].line : 0;
  }
  return line;
}

/* The nodes, by body, in a list BODY.NODE,BODY.NODE; BODY alone is its origin, whose load is an input anyway.
   0: it has been said which is none. */
static int scene_code_nodes(scene *s, node_set nodes[FB_MAX_BODIES], const char *option, const char *list)
{
  for (const char *at = list; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
    const int n = (int)strcspn(at, ",");
    char name[2 * TEXT_NAME], *part;
    int body = 0, node = -1;
    snprintf(name, sizeof name, "%.*s", n, at);
    part = name + strcspn(name, ".");
    part += *part ? (*part = '\0', 1) : 0;
    while (body < s->n_body && strcmp(s->body[body].name, name) != 0) {
      body++;
    }
    if (body < s->n_body && at[n - 1] != '.') {
      node = *part ? scene_find_node(&s->body[body], part) : 0;
    }
    if (node < 0 || node_is_in(&nodes[body], node)) {
      scene_code_no_node(s, option, name, part, body, node);
      return 0;
    }
    node_put(&nodes[body], node);
  }
  return 1;
}

/* How many lines load nodes that are no inputs yet, which `list` then names. */
static int scene_code_loads(char list[TEXT_MESSAGE], const scene *s, const node_set loads[FB_MAX_BODIES])
{
  node_set told[FB_MAX_BODIES];
  int n = 0;
  memcpy(told, loads, sizeof told);
  list[0] = '\0';
  for (int k = 0; k < s->n_load; k++) {
    const int body = s->load[k].body, node = s->load[k].node;
    const char *const name = s->body[body].node_name[node];
    const size_t at = strlen(list);
    if (node_is_in(&told[body], node)) {
      continue;
    }
    node_put(&told[body], node);
    n++;
    if (node == 0 || name[0]) {
      snprintf(list + at, TEXT_MESSAGE - at, "%s%s%s%s", at > 0 ? "," : "", s->body[body].name, node > 0 ? "." : "",
               node > 0 ? name : "");
    } else {
      snprintf(list + at, TEXT_MESSAGE - at, "%s%s.%d", at > 0 ? "," : "", s->body[body].name, node);
    }
  }
  return n;
}

/* What of a scene is neither body nor joint, and would be missing in the step: refused, all of it at once. Loads at
   nodes that --loads names are inputs. */
static int scene_code_refused(scene *s, const char *option, const node_set loads[FB_MAX_BODIES])
{
  char all[TEXT_MESSAGE] = "", list[TEXT_MESSAGE], load[TEXT_MESSAGE + 80];
  const int n_load = scene_code_loads(list, s, loads);
  const struct {
    int n, line; /* of the first; 0: none of its own */
    const char *what;
  } other[] = {{!scene_is_system(s) && !s->is_exact, 0,
                "one body without a joint: flexbeam reduce writes its step of rk4; on a joint of kind free to the "
                "ground it is a "
                "tree, of rk4 or sdirk"},
               {n_load, text_seen(&s->seen, text_seen(&s->seen, "load") > 0 ? "load" : "nudge"), load},
               {s->n_distributed, text_seen(&s->seen, "distributed"), "distributed: choose a scene without"},
               {s->n_motion, text_seen(&s->seen, "motion"), "motion: choose a scene without"},
               {scene_code_motor(s) > 0, scene_code_motor(s), "motor of a loop: choose one on a joint of the tree"},
               {s->n_event, text_seen(&s->seen, "event"), "event: choose a scene without"},
               {s->is_exact, 0, "an exact beam: choose bodies of modes"}};
  snprintf(load, sizeof load, "load and nudge: the caller gives them as input, by --loads %s", list);
  for (int k = 0; k < (int)(sizeof other / sizeof *other); k++) {
    const size_t n = strlen(all);
    if (other[k].n > 0) {
      snprintf(all + n, sizeof all - n, other[k].line > 0 ? "%s%s (line %d)" : "%s%s", n > 0 ? "; " : "", other[k].what,
               other[k].line);
    }
  }
  return all[0] ? scene_fail(s, "%s: %s", option, all) : 0;
}

/* Lines in whose place the step has inputs; where the scene starts they count. And the integrator, where it is left to the
   program. */
static void scene_code_tell(const scene *s, const char *option)
{
  unsigned char pulls[FB_MAX_SPRINGS];
  const int pulled = scene_code_pulls(pulls, s);
  const struct {
    int n, line; /* of the first */
    const char *what;
  } given[] = {{s->n_drive, s->drive[0].line, "motor, value and rate of joints"},
               {scene_code_rotors(s), text_seen(&s->seen, "rotor"), "motor and momentum of rotors"},
               {pulled > 0, pulled, "pull of springs"},
               {s->n_control, text_seen(&s->seen, "control"), "control"}};
  for (int k = 0; k < (int)(sizeof given / sizeof *given); k++) {
    if (given[k].n > 0) {
      fprintf(stderr, "%s: %s (from line %d) are inputs of the step, which the caller gives\n", option, given[k].what,
              given[k].line);
    }
  }
  if (s->integrator_auto && !(s->step > 0) && strcmp(option, "--code") == 0) { /* with a step auto is that */
    fprintf(stderr, "--code: integrator auto: the step is that of rk4; for stiff joints and modes choose sdirk\n");
  }
}

/* The name of what is written: that of the file up to its dot; 0: none that C takes. */
static int scene_code_name(char name[64], const char *file)
{
  const char *const slash = strrchr(file, '/'), *const base = slash ? slash + 1 : file;
  const size_t n = strcspn(base, ".");
  if (n >= 40) { /* longer ones would make lines that are too long */
    return 0;
  }
  memcpy(name, base, n);
  name[n] = '\0';
  return model_is_name(name) && strncmp(name, "fb_", 3) != 0 && strncmp(name, "fbi_", 4) != 0 &&
         strncmp(name, "FB_", 3) != 0;
}

typedef struct scene_code {
  const char *file, *loads, *sensors; /* lists of nodes; NULL: none */
  int single, lanes, jacobian;
} scene_code;

static const char *scene_code_node_name(int body, int node)
{
  return scene_code_of->body[body].node_name[node];
}

/* Names of the nodes and rotors of a body, by the numbers that they have in what is written. */
static void scene_code_list(FILE *out, int body)
{
  const scene *const s = scene_code_of;
  for (int k = 1; k < s->body[body].n_node; k++) {
    fprintf(out, "%s%d ", k > 1 ? ", " : "; nodes ", k);
    output_source(out, s->body[body].node_name[k]);
  }
  for (int k = 0; k < s->n_rotor; k++) {
    if (s->rotor[k].body == body) {
      fprintf(out, "%s%d ", s->rotor[k].at > 0 ? ", " : "; rotors ", s->rotor[k].at);
      output_source(out, s->rotor[k].text.name);
    }
  }
}

/* The step by a trace; 1, or 0 with why not in text. */
static int scene_code_trace(FILE *out, const tree_choice *choice, const char *const *names, char text[400])
{
  const trace_choice what = {.name = choice->name,
                             .file = scene_code_of->path,
                             .single = choice->single,
                             .loads = choice->loads,
                             .body = names,
                             .node_name = scene_code_node_name,
                             .pulls = choice->pulls,
                             .implicit = choice->implicit};
  const trace_model of = {engine.body,           &engine.system,       &engine.system_state,
                          sizeof engine.body[0], sizeof engine.system, sizeof engine.system_state,
                          scene_code_of->n_body};
  const code w = tree_begin(out, &engine.system, engine.body, names, choice);
  tree_write_head(&w, scene_code_of->path, fb_system_crc(&engine.system, engine.body, scene_code_of->n_body));
  return !code_write_steps(&w, what, &of, choice->lanes, tree_write_types, text);
}

/* The rates with their Jacobian; 1, or 0 with why not in text. */
static int scene_code_derive(FILE *out, const tree_choice *choice, const node_set sensors[FB_MAX_BODIES],
                             const char *const *names, char text[400])
{
  const trace_choice what = {.name = choice->name,
                             .file = scene_code_of->path,
                             .single = choice->single,
                             .loads = choice->loads,
                             .sensors = sensors,
                             .body = names,
                             .node_name = scene_code_node_name,
                             .pulls = choice->pulls};
  const trace_model of = {engine.body,           &engine.system,       &engine.system_state,
                          sizeof engine.body[0], sizeof engine.system, sizeof engine.system_state,
                          scene_code_of->n_body};
  return trace_write(out, &what, &of, text) == 0;
}

/* Writes the step, or the rates with their Jacobian, to a file. A status of main, 2 and a message for what cannot be
   written. */
static int scene_write_code(scene *s, const scene_code *c)
{
  static const scene_options nothing;
  const char *const option = c->jacobian ? "--jacobian" : "--code", *names[FB_MAX_BODIES];
  char name[64], text[400] = "";
  node_set sensors[FB_MAX_BODIES] = {{{0}}};
  tree_choice choice = {name,    c->single, c->lanes,       s->integrator == FB_INTEGRATOR_SDIRK, &engine.system_state,
                        {{{0}}}, {0},       scene_code_list};
  FILE *out;
  fb_status status;
  int good;
  clear_memory(&engine, offsetof(struct scene_engine, body));
  scene_code_of = s;
  if (!scene_code_nodes(s, choice.loads, "--loads", c->loads) ||
      !scene_code_nodes(s, sensors, "--sensors", c->sensors) || scene_code_refused(s, option, choice.loads)) {
    return 2;
  }
  scene_code_pulls(choice.pulls, s);
  if (!scene_code_name(name, c->file)) {
    return 1 + scene_fail(s,
                          "%s %s: the functions are called as their file, whose name wants to be a C identifier of at "
                          "most 39 characters, not fb_..",
                          option, c->file);
  }
  if (scene_build(s, &nothing)) {
    return 2;
  }
  status = system_start(s);
  status = status == FB_OK ? scene_look(s, 0) : status;
  if (status != FB_OK) {
    return 1 + scene_failed(s, "the start", status);
  }
  scene_tell_moved(s, stderr);
  scene_code_tell(s, option);
  for (int k = 0; k < s->n_body; k++) {
    names[k] = s->body[k].name;
  }
  out = output_open(c->file);
  if (!out) {
    return 1 + scene_fail(s, "cannot write %s: %s", c->file, output_why());
  }
  good =
      c->jacobian ? scene_code_derive(out, &choice, sensors, names, text) : scene_code_trace(out, &choice, names, text);
  if (!good) {
    output_drop(out, c->file);
    return 1 + scene_fail(s, "%s: %s", option, text);
  }
  return output_close(out, c->file);
}
#endif
