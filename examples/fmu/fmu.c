/* fmu - a body or a scene from a text file becomes an FMU: its model as C, or the text that it runs, beside the library and
   the interface of FMI 2.0 or 3.0, compiled for the machine at hand, described and packed. POSIX (fork, mkdtemp, uname); wants cc, and zip or python3.
   Exit: 0 well, 1 the model cannot be built or packed, 2 bad options or input. */
#define _POSIX_C_SOURCE 200809L
static int fmu_fmi; /* version of FMI */
#define FMU_INTERFACE ((unsigned)fmu_fmi)
#include "fmu_scene.h"
#include "../tools/config.h"
#include "../tools/rom.h"
#define PROGRAM "fmu"
#include "../tools/words.h"
#include "../common/options.h"
#include "../common/output.h"
#include "../common/same_file.h"
#include "fmu_icon.h"
#include <sys/stat.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <unistd.h>

static const char help[] =
    "fmu - a body or a scene from a text file as an FMU for co-simulation: sources, a binary for this machine,\n"
    "documentation\n"
    "usage: flexbeam fmu FILE --out NAME.fmu [options]\n"
    "  --version 2|3   of FMI (2)\n"
    "  --step SECONDS  of the integrator, the start value of settings.step (a fifth of what rk4 takes at rest; of a "
    "scene\n"
    "                  as it says itself)\n"
    "  --static        one instance a process, in static memory: no heap\n"
    "  --binary FILE   of a scene: the file in binaries/ of another scene's FMU of this version, instead of compiling "
    "it again\n"
    "  --sources DIR   where flexbeam.h is (.)\n"
    "  --help          this text\n"
    "The compiler is cc, or $CC. The descriptions of bodies are explained in examples/tools/README.md, scenes in\n"
    "examples/scenes/README.md, the FMU in examples/fmu/README.md.\n";

/* ---- files of the folder that is packed */

enum { MAX_PATH = 1056, MAX_NAME = 160, MAX_FILES = 256, MAX_WORDS = 16 };

static struct folder {
  char path[MAX_PATH];
  int n;
  char made[MAX_FILES][MAX_NAME]; /* files and folders in it, in the order in which they were made */
} folder;

static void folder_path(char path[MAX_PATH], const char *name)
{
  snprintf(path, MAX_PATH, "%.880s/%.159s", folder.path, name);
}

static void folder_note(const char *name)
{
  if (folder.n < MAX_FILES) {
    snprintf(folder.made[folder.n++], sizeof folder.made[0], "%s", name);
  }
}

/* 0, or 1 after a message. */
static int folder_make(const char *name)
{
  char path[MAX_PATH];
  folder_path(path, name);
  if (mkdir(path, 0777) != 0) {
    fprintf(stderr, "fmu: %s: %s\n", path, strerror(errno));
    return 1;
  }
  folder_note(name);
  return 0;
}

/* A new file in it; NULL after a message. */
static FILE *folder_open(const char *name)
{
  char path[MAX_PATH];
  FILE *out;
  folder_path(path, name);
  out = fopen(path, "wb");
  if (!out) {
    fprintf(stderr, "fmu: %s: %s\n", path, strerror(errno));
  } else {
    folder_note(name);
  }
  return out;
}

static int folder_write(const char *name, void (*write)(FILE *out, const fmu_export *e), const fmu_export *e)
{
  FILE *const out = folder_open(name);
  if (!out) {
    return 1;
  }
  write(out, e);
  return output_close(out, name) != 0;
}

/* from: beside `sources`; NULL: where it says. */
static int folder_copy(const char *name, const char *sources, const char *from)
{
  char path[MAX_PATH], part[4096];
  FILE *in, *out;
  size_t n;
  snprintf(path, sizeof path, "%.880s%s%.128s", sources, from ? "/" : "", from ? from : "");
  in = fopen(path, "rb");
  if (!in) {
    fprintf(stderr, "fmu: %s: %s (run it at the top of flexbeam, or say --sources)\n", path, strerror(errno));
    return 1;
  }
  out = folder_open(name);
  while (out && (n = fread(part, 1, sizeof part, in)) > 0) {
    fwrite(part, 1, n, out);
  }
  fclose(in);
  return !out || output_close(out, name) != 0;
}

static void folder_remove(void)
{
  char path[MAX_PATH];
  while (folder.n > 0) {
    folder_path(path, folder.made[--folder.n]);
    remove(path);
  }
  if (folder.path[0]) {
    rmdir(folder.path);
  }
}

static volatile sig_atomic_t stopped; /* number of a signal: no program is run any more, and the folder goes */

static void stop(int number)
{
  stopped = number;
}

/* One that is ignored stays so. */
static void watch_signals(void)
{
  static const int numbers[] = {SIGINT, SIGTERM};
  struct sigaction now, then;
  memset(&then, 0, sizeof then);
  then.sa_handler = stop;
  for (int k = 0; k < 2; k++) {
    if (sigaction(numbers[k], NULL, &now) == 0 && now.sa_handler != SIG_IGN) {
      sigaction(numbers[k], &then, NULL);
    }
  }
}

/* Waits for it; a signal is passed on. */
static int folder_wait(pid_t child, int *status)
{
  pid_t ended;
  while ((ended = waitpid(child, status, 0)) < 0 && errno == EINTR) {
    kill(child, stopped ? stopped : SIGTERM);
  }
  return ended == child && WIFEXITED(*status);
}

/* A program in the folder: its exit status; 127: there is none. */
static int folder_run(char *const argv[])
{
  int status = 0;
  const pid_t child = stopped ? -1 : fork();
  if (child == 0) {
    if (chdir(folder.path) == 0) {
      execvp(argv[0], argv);
    }
    _exit(127);
  }
  if (child < 0 || !folder_wait(child, &status) || stopped) {
    return 126;
  }
  return WEXITSTATUS(status);
}

/* ---- what is written into it */

/* What the FMU of a scene has to know, as a header. */
static void write_scene_config(FILE *out, const fmu_export *e)
{
  fprintf(out,
          "/* fmu_config.h - this FMU is that of a scene, the same for all of them; made by flexbeam fmu */\n"
          "#define FMU_OF_A_SCENE 1\n"
          "#ifndef FMU_STATIC /* 1: the instance in static memory, too */\n#define FMU_STATIC %d\n#endif\n",
          e->is_static);
}

/* The smallest configuration that the model takes, as a header; beams of large deflection are built by way of tables
   of all sizes. */
static void write_config(FILE *out, const fmu_export *e)
{
  static const char *const tables[] = {"FB_MAX_LAMBDA", "FB_MAX_S"};
  const int large = (e->body->effects & FB_EFFECT_LARGE_DEFLECTION) != 0;
  char option[80];
  FILE *const flags = tmpfile();
  fprintf(out, "/* fmu_config.h - configuration of flexbeam for the model of this FMU, made by flexbeam fmu */\n");
  if (flags) {
    config_flags(flags, e->body, 0, "");
    rewind(flags);
    while (fscanf(flags, " -D%79s", option) == 1) {
      char *const value = strchr(option, '=');
      int left_out = 0;
      if (value) {
        *value = 0;
      }
      for (int k = 0; k < (int)(sizeof tables / sizeof *tables) && large; k++) {
        left_out |= strcmp(option, tables[k]) == 0;
      }
      if (value && !left_out) {
        fprintf(out, "#define %s %s\n", option, value + 1);
      }
    }
    fclose(flags);
  }
  fprintf(out,
          "#define FB_MAX_LOADS FB_MAX_NODES\n#define FB_MAX_ELEMENTS 1\n#define FB_MAX_STATIONS 1\n"
          "#define FB_MAX_LUMPS 1\n#define FB_WITH_SYSTEM 0\n#define FB_WITH_EXACT 0\n#define FB_WITH_ANALYSE 0\n"
          "#define FB_WITH_DETAIL 1\n"
          "#define FMU_OF_A_SCENE 0\n#define FMU_TOKEN \"%s\"\n#define FMU_STEP_DEFAULT %.17g\n"
          "#ifndef FMU_STATIC /* 1: one instance in static memory; modelDescription.xml has to say the same */\n"
          "#define FMU_STATIC %d\n#endif\n",
          e->token, e->step, e->is_static);
}

static void write_model(FILE *out, const fmu_export *e)
{
  const fmu_parts *const p = e->parts;
  rom r = {out, 0, 0, 0, 0};
  rom_write(out, e->body, "fmu_model", e->name, 0);
  fputs("\nstatic const fmu_parts fmu_model_parts = {\n", out);
  rom_shape(out, "rest", &p->rest, e->body, 0);
  rom_desc(out, "desc", &p->desc, e->body->n, 0);
  rom_number(&r, "hub_mass", p->hub_mass);
  rom_reals(&r, "hub_center", p->hub_center, 3);
  rom_reals(&r, "hub_inertia", p->hub_inertia, 6);
  fputs("\n};\n", out);
  fputs("static const char *const fmu_node_name[] = {", out);
  for (int k = 0; k < e->body->n_node; k++) {
    fprintf(out, "%s\"%s\"", k ? ", " : "", e->node[k]);
  }
  fputs("};\n", out);
}

static const char *const interfaces[2][5] = {
    {"examples/fmu/fmu2.c", "examples/fmu/fmi2/fmi2Functions.h", "examples/fmu/fmi2/fmi2FunctionTypes.h",
     "examples/fmu/fmi2/fmi2TypesPlatform.h", NULL},
    {"examples/fmu/fmu3.c", "examples/fmu/fmi3/fmi3Functions.h", "examples/fmu/fmi3/fmi3FunctionTypes.h",
     "examples/fmu/fmi3/fmi3PlatformTypes.h", NULL}};

static time_t sources_changed; /* when, at the latest, of those that were copied */

/* Files of the project, up to NULL, into that folder; folder NULL: into their own below `sources`. */
static int copy_sources(const char *const *list, const char *folder_name, const char *sources)
{
  char path[MAX_PATH];
  struct stat there;
  int failed = 0;
  for (int k = 0; list[k] && !failed; k++) {
    const char *const slash = strrchr(list[k], '/');
    char to[MAX_NAME];
    snprintf(to, sizeof to, "%.60s/%.90s", folder_name ? folder_name : "sources",
             folder_name && slash ? slash + 1 : list[k]);
    failed = folder_copy(to, sources, list[k]);
    snprintf(path, sizeof path, "%.880s/%.128s", sources, list[k]);
    if (stat(path, &there) == 0 && there.st_mtime > sources_changed) {
      sources_changed = there.st_mtime;
    }
  }
  return failed;
}

static int write_sources(const fmu_export *e, const char *sources)
{
  static const char *const common[] = {"flexbeam.h",
                                       "flexbeam_impl.h",
                                       "examples/common/clear.h",
                                       "examples/common/refusal.h",
                                       "examples/common/stepper.h",
                                       "examples/fmu/fmu_variables.h",
                                       "examples/fmu/fmu_body.h",
                                       "examples/fmu/fmu_core.h",
                                       "examples/fmu/fmu_instance.h",
                                       NULL};
  int failed = folder_make("sources") || copy_sources(common, "sources", sources) ||
               copy_sources(interfaces[e->fmi - 2], "sources", sources);
  failed = failed || folder_write("sources/fmu_config.h", write_config, e);
  failed = failed || folder_write("sources/fmu_model.h", write_model, e);
  return failed || (e->fmi == 3 && folder_write("sources/buildDescription.xml", fmu_write_build, e));
}

/* Those of a scene keep their folders: its headers include each other by them. */
static int write_scene_sources(const fmu_export *e, const char *sources)
{
  static const char *const folders[] = {"sources",
                                        "sources/examples",
                                        "sources/examples/common",
                                        "sources/examples/tools",
                                        "sources/examples/scene",
                                        "sources/examples/fmu"};
  static const char *const all[] = {"flexbeam.h",
                                    "flexbeam_impl.h",
                                    "examples/common/clear.h",
                                    "examples/common/csv.h",
                                    "examples/common/filter.h",
                                    "examples/common/linear_out.h",
                                    "examples/common/output.h",
                                    "examples/common/refusal.h",
                                    "examples/common/rotor_text.h",
                                    "examples/common/section_doubt.h",
                                    "examples/common/spectrum.h",
                                    "examples/common/stepper.h",
                                    "examples/common/text.h",
                                    "examples/tools/capacities.h",
                                    "examples/tools/inside.h",
                                    "examples/tools/model.h",
                                    "examples/tools/exact_curve.h",
                                    "examples/tools/exact_text.h",
                                    "examples/scene/control.h",
                                    "examples/scene/function.h",
                                    "examples/scene/scene.h",
                                    "examples/scene/scene_auto.h",
                                    "examples/scene/scene_body.h",
                                    "examples/scene/scene_check.h",
                                    "examples/scene/scene_control.h",
                                    "examples/scene/scene_draw.h",
                                    "examples/scene/scene_engine.h",
                                    "examples/scene/scene_exact.h",
                                    "examples/scene/scene_joint.h",
                                    "examples/scene/scene_linear.h",
                                    "examples/scene/scene_margins.h",
                                    "examples/scene/scene_modes.h",
                                    "examples/scene/scene_parts.h",
                                    "examples/scene/scene_rotor.h",
                                    "examples/scene/scene_run.h",
                                    "examples/scene/scene_seen.h",
                                    "examples/scene/scene_shapes.h",
                                    "examples/scene/scene_time.h",
                                    "examples/scene/scene_wanted.h",
                                    "examples/fmu/fmu_variables.h",
                                    "examples/fmu/fmu_scene.h",
                                    "examples/fmu/fmu_core.h",
                                    "examples/fmu/fmu_instance.h",
                                    NULL};
  int failed = 0;
  for (size_t k = 0; k < sizeof folders / sizeof folders[0] && !failed; k++) {
    failed = folder_make(folders[k]);
  }
  failed = failed || copy_sources(all, NULL, sources) ||
           copy_sources(interfaces[e->fmi - 2], "sources/examples/fmu", sources);
  failed = failed || folder_write("sources/examples/fmu/fmu_config.h", write_scene_config, e);
  return failed || (e->fmi == 3 && folder_write("sources/buildDescription.xml", fmu_write_build, e));
}

/* The icon: of FMI 2 beside the model description, of FMI 3 in a folder of its own. */
static int write_icon(const fmu_export *e)
{
  if (e->fmi == 2) {
    return folder_write("model.png", icon_write_png, e);
  }
  return folder_make("terminalsAndIcons") || folder_write("terminalsAndIcons/icon.png", icon_write_png, e) ||
         folder_write("terminalsAndIcons/icon.svg", icon_write_svg, e);
}

static int write_documents(const fmu_export *e, const char *sources)
{
  int failed = folder_make("documentation") || folder_make("documentation/licenses");
  failed = failed || folder_copy("documentation/licenses/license.txt", sources, "LICENSE");
  failed = failed || folder_write("documentation/index.html", fmu_write_page, e) || write_icon(e);
  return failed || folder_write("modelDescription.xml", fmu_write_description, e);
}

/* Name of the machine's folder among the binaries. */
static int find_platform(char name[64], int fmi)
{
  struct utsname machine;
  const char *system;
  if (uname(&machine) != 0) {
    return 1;
  }
  system = strcmp(machine.sysname, "Darwin") == 0 ? "darwin" : strcmp(machine.sysname, "Linux") == 0 ? "linux" : NULL;
  if (!system) {
    return 1;
  }
  if (fmi == 2 && strcmp(machine.machine, "x86_64") == 0) {
    snprintf(name, 64, "%s64", system);
  } else {
    const char *const kind = strcmp(machine.machine, "arm64") == 0 ? "aarch64" : machine.machine;
    snprintf(name, 64, "%.32s-%s", kind, system);
  }
  return 0;
}

/* Words of $CC, as `gcc -O1`, into argv: their number; 0 after a message. */
static int read_compiler(char *argv[MAX_WORDS], char text[MAX_PATH])
{
  static const char blanks[] = " \t\n";
  const char *const cc = getenv("CC");
  int n = 0;
  snprintf(text, MAX_PATH, "%s", cc && cc[strspn(cc, blanks)] ? cc : "cc");
  for (char *word = strtok(text, blanks); word && n < MAX_WORDS; word = strtok(NULL, blanks)) {
    argv[n++] = word;
  }
  if (n == MAX_WORDS || (cc && strlen(cc) >= MAX_PATH)) {
    fprintf(stderr, "fmu: CC is too long: at most %d words, %d characters\n", MAX_WORDS - 1, MAX_PATH - 1);
    return 0;
  }
  return n;
}

/* Does a file begin as an FMU does, a zip archive? */
static int is_packed(const char *path)
{
  char begin[2] = "";
  FILE *const file = fopen(path, "rb");
  const int packed = file && fread(begin, 1, 2, file) == 2 && memcmp(begin, "PK", 2) == 0;
  if (file) {
    (void)fclose(file);
  }
  return packed;
}

/* What make has built for the FMUs of all scenes, if it is not older than the sources and the compiler is not chosen
   by CC; else NULL. */
static const char *find_built(char path[MAX_PATH], const fmu_export *e, const char *sources)
{
  const char *const cc = getenv("CC");
  struct stat there;
  snprintf(path, MAX_PATH, "%.880s/build/tool/fmu%d.so", sources, e->fmi);
  return !e->body && !e->is_static && !(cc && *cc) && stat(path, &there) == 0 && there.st_mtime >= sources_changed
             ? path
             : NULL;
}

/* Into binaries/, where `binary` may be there already. */
static int compile(const fmu_export *e, const char *binary)
{
  char place[MAX_NAME], file[MAX_NAME], source[64], text[MAX_PATH];
  char *const options[] = {(char *)"-std=c99",
                           (char *)"-ffp-contract=off",
                           (char *)"-fPIC",
                           (char *)"-shared",
                           (char *)"-fvisibility=hidden",
                           (char *)"-Isources",
                           (char *)"-o",
                           file,
                           source,
                           (char *)"-lm",
                           NULL};
  char *argv[MAX_WORDS + 1 + sizeof options / sizeof options[0]];
  const int n = read_compiler(argv, text);
  int status, at = 1;
  if (n == 0) {
    return 1;
  }
  while (at < n && argv[at][0] != '-') {
    at++;
  }
  memmove(argv + at + 1, argv + at, (size_t)(n - at) * sizeof *argv); /* another -O of $CC comes behind it */
  argv[at] = (char *)"-O2";
  memcpy(argv + n + 1, options, sizeof options);
  snprintf(source, sizeof source, "sources/%sfmu%d.c", e->body ? "" : "examples/fmu/", e->fmi);
  snprintf(place, sizeof place, "binaries/%.60s", e->platform);
  snprintf(file, sizeof file, "binaries/%.60s/%.63s.%s", e->platform, e->name,
           strstr(e->platform, "darwin") ? "dylib" : "so");
  if (folder_make("binaries") || folder_make(place)) {
    return 1;
  }
  if (binary) {
    return folder_copy(file, binary, NULL);
  }
  folder_note(file);
  status = folder_run(argv);
  if (status != 0) {
    fprintf(stderr, status == 127 ? "fmu: there is no compiler %s (set CC)\n" : "fmu: %s cannot compile the sources\n",
            argv[0]);
  }
  return status != 0;
}

static int pack(const char *out, const fmu_export *e)
{
  char *const parts[] = {(char *)"modelDescription.xml",
                         (char *)"binaries",
                         (char *)"documentation",
                         (char *)"sources",
                         (char *)(e->fmi == 2 ? "model.png" : "terminalsAndIcons"),
                         e->body ? NULL : (char *)"resources",
                         NULL};
  char *zip[5 + sizeof parts / sizeof parts[0]] = {(char *)"zip", (char *)"-q", (char *)"-X", (char *)"-r",
                                                   (char *)"model.zip"};
  char *python[5 + sizeof parts / sizeof parts[0]] = {(char *)"python3", (char *)"-m", (char *)"zipfile", (char *)"-c",
                                                      (char *)"model.zip"};
  char path[MAX_PATH];
  int status;
  memcpy(zip + 5, parts, sizeof parts);
  memcpy(python + 5, parts, sizeof parts);
  status = folder_run(zip);
  status = status == 127 ? folder_run(python) : status;
  folder_note("model.zip");
  folder_path(path, "model.zip");
  if (status != 0) {
    fprintf(stderr, status == 127 ? "fmu: wants zip or python3 to pack\n" : "fmu: %s cannot be packed\n", out);
  } else if (rename(path, out) != 0) {
    fprintf(stderr, "fmu: %s: %s\n", out, strerror(errno));
    status = 1;
  }
  return status != 0;
}

/* ---- the body */

static int name_is_taken(const fmu_export *e, const char *name)
{
  static const char *const words[] = {"hub", "base", "modes", "energy", "settings", "start", "time", "gravity"};
  int taken = 0;
  for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
    taken |= strcmp(name, words[i]) == 0;
  }
  for (int k = 0; k < e->body->n_node; k++) {
    taken |= strcmp(name, e->node[k]) == 0;
  }
  return taken;
}

/* Names of the nodes: hub, those of the description; then node3 for one that has none or one that is taken (where node3
   is the name of another: node3 and the number of nodes, and so on). */
static void name_nodes(fmu_export *e)
{
  const int n = e->body->n_node;
  for (int k = 0; k < n; k++) {
    const char *const name = model.node_name[k];
    if (k > 0 && !isdigit((unsigned char)name[0]) && !name_is_taken(e, name)) {
      snprintf(e->node[k], sizeof e->node[k], "%s", name);
    }
  }
  strcpy(e->node[0], "hub");
  for (int k = 1; k < n; k++) {
    char own[TEXT_NAME + 8] = ""; /* taken, by node k itself, which has none */
    for (int number = k; !e->node[k][0] && name_is_taken(e, own); number += n) {
      snprintf(own, sizeof own, "node%d", number);
    }
    if (!e->node[k][0]) {
      strcpy(e->node[k], own);
    }
  }
}

static unsigned word_of_text(unsigned word, const char *text)
{
  for (const char *c = text; *c; c++) {
    word = fbi_crc_word(word, (unsigned char)*c);
  }
  return word;
}

/* The same for the same model, variables and version. */
static void make_token(fmu_export *e)
{
  unsigned name = word_of_text(~0u, e->name), rest = word_of_text(~0u, FB_VERSION);
  const fb_real step = (fb_real)e->step;
  unsigned long long tail;
  for (int k = 0; k < e->body->n_node; k++) {
    name = word_of_text(name, e->node[k]);
  }
  rest = fbi_crc_reals(rest, &step, 1, 0);
  rest = fbi_crc_reals(rest, &e->parts->hub_mass, 1, 0);
  rest = fbi_crc_reals(rest, e->parts->hub_center, 3, 0);
  rest = fbi_crc_reals(rest, e->parts->hub_inertia, 6, 0);
  rest = fbi_crc_word(fbi_crc_word(rest, (unsigned)e->fmi), (unsigned)e->is_static);
  tail = (unsigned long long)fbi_crc_word(name, rest) << 16 ^ rest;
  snprintf(e->token, sizeof e->token, "{%08x-%04x-%04x-%04x-%012llx}", fbi_body_crc(e->body, 0), name >> 16,
           name & 0xFFFFu, rest >> 16, tail & 0xFFFFFFFFFFFFull);
}

/* The largest of 1, 2, 5 times a power of ten that is a fifth of what rk4 takes, or 0.01 s. */
static double make_step(const fb_body *body)
{
  const double most = fmin(0.01, (double)fb_rk4_limit(body, FB_R(0.0), FB_R(0.0)) / 5);
  const double ten = pow(10, floor(log10(most)));
  const double part = most / ten;
  return (part >= 5 ? 5 : part >= 2 ? 2 : 1) * ten;
}

/* What the FMU builds it of: the shape without the hub. */
static fb_status build_parts(fmu_parts *parts, const char **what)
{
  const int hub = model.hub;
  fb_status status;
  model.hub = 0;
  status = model_build_shape(what);
  model.hub = hub;
  parts->rest = model_shape;
  parts->desc = model.level;
  parts->hub_mass = (fb_real)(hub ? model.hub_mass : 0);
  for (int i = 0; i < 6 && hub; i++) {
    parts->hub_center[i % 3] = (fb_real)model.hub_center[i % 3];
    parts->hub_inertia[i] = (fb_real)model.hub_inertia[i];
  }
  return status;
}

/* 0, 1 or 2 as the program. */
static int build(const char *file, fmu_parts *parts)
{
  const char *what;
  fb_status status;
  if (!model_read(PROGRAM, file)) {
    return 2;
  }
  if (model.level.n_rotor > 0) {
    fprintf(stderr, "fmu: %s: rotor %s: an FMU has no rotors: a wheel acts on its node by torques of the simulator\n",
            file, model.rotor[0].text.name);
    return 1;
  }
  if (model.level.effects & FB_EFFECT_NONLINEAR_STRAIN) {
    fprintf(stderr, "fmu: %s: effects strain: the FMU of a body has none: make it of a scene with this body\n", file);
    return 1;
  }
  if (!(model.level.mu > FB_R(0.0))) {
    model.level.effects |= FB_EFFECT_GRAVITY; /* an input */
  }
  status = build_parts(parts, &what);
  status = status ? status : model_build(&what);
  if (status != FB_OK) {
    fprintf(stderr, "fmu: %s: %s: %s\n", file, what, refusal_text(status));
    return 1;
  }
  return 0;
}

/* ---- the scene */

/* Is it one? A body begins with its kind. The description of a body tells what is wrong with a file that is neither. */
static int file_is_scene(const char *file)
{
  text_file t;
  struct stat at;
  const char *word = NULL;
  int kind = 0;
  if (is_file(file, &at) && text_try(&t, PROGRAM, file)) {
    word = text_line(&t) ? text_word(&t) : NULL;
    text_close(&t);
  }
  while (word && model_kinds[kind] && strcmp(word, model_kinds[kind]) != 0) {
    kind++;
  }
  return word && !model_kinds[kind];
}

/* Letters, digits and _ of the name of the file, without its ending. */
static void scene_name_of(char name[TEXT_NAME], const char *file)
{
  const char *const slash = strrchr(file, '/');
  const char *c = slash ? slash + 1 : file;
  int n = 0;
  if (isdigit((unsigned char)*c)) {
    name[n++] = '_';
  }
  for (; *c && *c != '.' && n < TEXT_NAME - 1; c++) {
    name[n++] = isalnum((unsigned char)*c) ? *c : '_';
  }
  name[n] = 0;
  if (n == 0) {
    strcpy(name, "scene");
  }
}

enum { MAX_NAMED = 32, MAX_UP = 8 };

typedef struct scene_folder { /* files that a scene names, relative to its folder */
  int n, up;                  /* up: the most folders that one goes up */
  char name[MAX_NAMED][MAX_NAME - 64];
} scene_folder;

/* How many folders a name goes up; -1: it is absolute, or goes up again below. */
static int scene_ups(const char *name)
{
  int up = 0;
  while (strncmp(name, "../", 3) == 0) {
    name += 3;
    up++;
  }
  return name[0] == '/' || strstr(name, "../") || strstr(name, "./") == name ? -1 : up;
}

/* Words of the scene that are names of files. 0, or 1 after a message. */
static int scene_find_files(scene_folder *found, const char *file)
{
  char path[512];
  const char *word;
  text_file t;
  int failed = 0;
  if (!text_open(&t, PROGRAM, file)) {
    return 1;
  }
  while (!failed && text_line(&t)) {
    while (!failed && (word = text_word(&t)) != NULL) {
      struct stat there;
      int k = 0;
      text_beside(path, file, word);
      while (k < found->n && strcmp(found->name[k], word) != 0) {
        k++;
      }
      if (k < found->n || stat(path, &there) != 0 || !S_ISREG(there.st_mode)) {
        continue;
      }
      failed = found->n == MAX_NAMED || strlen(word) >= sizeof found->name[0] || scene_ups(word) < 0 ||
               scene_ups(word) > MAX_UP;
      if (failed) {
        fprintf(
            stderr,
            "fmu: %s:%d: %s: an FMU takes at most %d files with it, of names of %d characters from the folder of the "
            "scene on, as ../FOLDER/FILE, at most %d up\n",
            file, t.line, word, MAX_NAMED, (int)sizeof found->name[0] - 1, MAX_UP);
      } else {
        strcpy(found->name[found->n++], word);
        found->up = scene_ups(word) > found->up ? scene_ups(word) : found->up;
      }
    }
  }
  text_close(&t);
  return failed;
}

/* The file, and the folders of it, below resources. */
static int scene_copy(const char *name, const char *beside, const char *word)
{
  char path[512], part[MAX_NAME];
  for (const char *slash = strchr(name, '/'); slash; slash = strchr(slash + 1, '/')) {
    struct stat there;
    char whole[MAX_PATH];
    snprintf(part, sizeof part, "%.*s", (int)(slash - name), name);
    folder_path(whole, part);
    if (stat(whole, &there) != 0 && folder_make(part)) {
      return 1;
    }
  }
  text_beside(path, beside, word);
  return folder_copy(name, path, NULL);
}

/* resources: what the scene reads, in folders that are to each other as it says, and the list of it. */
static int write_resources(const fmu_export *e, const char *file, double step)
{
  static scene_folder found;
  char down[3 * MAX_UP + 1] = "", name[MAX_NAME];
  const char *const slash = strrchr(file, '/');
  FILE *list;
  memset(&found, 0, sizeof found);
  if (scene_find_files(&found, file) || folder_make("resources")) {
    return 1;
  }
  list = folder_open("resources/flexbeam.txt");
  for (int k = 0; k < found.up; k++) {
    strcat(down, "d/");
  }
  snprintf(name, sizeof name, "resources/%s%s.txt", down, e->name);
  if (!list || scene_copy(name, file, slash ? slash + 1 : file)) {
    return 1;
  }
  fprintf(list, "scene %s\n", name + strlen("resources/"));
  if (step > 0) {
    fprintf(list, "step %.17g\n", step);
  }
  for (int k = 0; k < found.n; k++) {
    const int up = scene_ups(found.name[k]);
    snprintf(name, sizeof name, "resources/%.*s%s", 2 * (found.up - up), down, found.name[k] + 3 * up);
    if (scene_copy(name, file, found.name[k])) {
      return 1;
    }
    fprintf(list, "file %s\n", name + strlen("resources/"));
  }
  return output_close(list, "flexbeam.txt") != 0;
}

static fmu_plant staged; /* the scene, as an instance has it */

/* The scene as its FMU has it: that it starts, and its variables. */
static int open_scene(fmu_export *e)
{
  fmu_plant *const p = &staged;
  static fmu_plant_state state;
  static double value[FMU_SCENE_VARIABLES];
  char resources[MAX_PATH];
  fmu_text text = "";
  fmu_answer answer;
  folder_path(resources, "resources");
  answer = fmu_plant_open(p, resources, text);
  if (answer == FMU_OK) {
    const fmu_values all = {e->list, fmu_plant_variables(p, e->list), value};
    e->n = all.n;
    for (int k = 0; k < e->n; k++) {
      value[k] = e->list[k].start;
    }
    strcpy(e->token, fmu_plant_token(p));
    answer = fmu_plant_start(p, &state, &all, text);
    answer = answer ? answer : fmu_plant_outputs(p, &state, &all, text);
    answer = answer ? answer : fmu_plant_step(p, &state, &all, 0, timing.interval, text);
  }
  e->title = staged.s.title[0] ? staged.s.title : e->name;
  e->stop = staged.s.duration;
  e->is_exact = staged.s.is_exact;
  e->has_events = fmu_plant_has_events(&staged);
  e->step = timing.interval;
  if (answer != FMU_OK) {
    fprintf(stderr, "fmu: %s\n", text);
  }
  return answer != FMU_OK;
}

/* Is there a scene in the file, and one that moves? 0, or 2 after a message. */
static int check_scene(const char *file)
{
  fmu_text text = "";
  const fmu_answer answer = fmu_scene_read(&staged, file, NULL, 0, text);
  if (answer != FMU_OK) {
    fprintf(stderr, "fmu: %s\n", text);
  }
  return answer != FMU_OK ? 2 : 0;
}

typedef struct options {
  const char *out, *sources, *binary;
  int version;
  double step;
} options;

static int read_option(void *to, const char *name, const char *text)
{
  options *const o = (options *)to;
  const number_option step[] = {{"--step", &o->step, 1e-9, 10}};
  if (strcmp(name, "--out") == 0) {
    return read_out(&o->out, text);
  }
  if (strcmp(name, "--sources") == 0) {
    o->sources = text;
    return 0;
  }
  if (strcmp(name, "--binary") == 0) {
    o->binary = text;
    return 0;
  }
  if (strcmp(name, "--version") == 0) {
    return read_choice(&o->version, name, text, "2|3");
  }
  return read_number(step, 1, name, text);
}

/* The folder and what is in it, packed; a status of main. */
static int export_fmu(fmu_export *e, const char *file, const options *o)
{
  const int is_scene = !e->body;
  char built[MAX_PATH];
  int status;
  snprintf(folder.path, sizeof folder.path, "%s.XXXXXX", o->out);
  watch_signals();
  if (!mkdtemp(folder.path)) {
    fprintf(stderr, "fmu: %s: %s\n", o->out, strerror(errno));
    return 2;
  }
  status = is_scene && (write_resources(e, file, o->step) || open_scene(e));
  status = status || (is_scene ? write_scene_sources : write_sources)(e, o->sources) ||
           write_documents(e, o->sources) || compile(e, o->binary ? o->binary : find_built(built, e, o->sources)) ||
           pack(o->out, e);
  folder_remove();
  if (status && stopped) {
    fprintf(stderr, "fmu: stopped by a signal, %s is as it was\n", o->out);
  }
  return status && stopped ? 128 + stopped : status;
}

int fmu_main(int argc, char **argv)
{
  static fmu_export e;
  static fmu_parts parts;
  static char platform[64], name[TEXT_NAME];
  const int is_static = take_flag(&argc, argv, "--static"), named = argc > 1 && argv[1][0] != '-';
  const int is_scene = named && file_is_scene(argv[1]);
  options o = {NULL, ".", NULL, 0, 0};
  int status;
  struct stat there;
  output_begin(PROGRAM);
  if (read_all(argc - named, argv + named, help, read_option, &o) != 0) {
    return 2;
  }
  if (!named || !o.out) {
    return fail(named ? "--out is missing" : "a description is missing", "");
  }
  if (stat(argv[1], &there) == 0 && !S_ISREG(there.st_mode)) {
    return fail("a description is a file: it is read more than once", argv[1]);
  }
  if (o.binary && !is_scene) {
    return fail("--binary is of scenes: that of a body is its own", o.binary);
  }
  if (o.binary && is_packed(o.binary)) {
    return fail("--binary wants what an FMU holds in binaries/, not the FMU", o.binary);
  }
  if (lstat(o.out, &there) == 0 && !S_ISREG(there.st_mode)) {
    return fail("a link, a device, a pipe or a folder, where an FMU becomes a file of its own", o.out);
  }
  if (same_file(argv[1], o.out)) {
    return fail("--out: that is the description itself", o.out);
  }
  fmu_fmi = e.fmi = o.version + 2;
  status = is_scene ? check_scene(argv[1]) : build(argv[1], &parts);
  if (status != 0) {
    return status;
  }
  e.is_static = is_static;
  e.platform = platform;
  if (is_scene) {
    scene_name_of(name, argv[1]);
    e.name = name;
  } else {
    e.name = model.name;
    e.body = &model_body;
    e.step = o.step > 0 ? o.step : make_step(&model_body);
    e.parts = &parts;
    e.n = fmu_variables(e.list, &model_body, &parts);
    name_nodes(&e);
    make_token(&e);
  }
  if (find_platform(platform, e.fmi)) {
    return fail("what machine this is nobody tells: there is no name for its binary", "");
  }
  status = export_fmu(&e, argv[1], &o);
  if (status == 0 && is_scene) {
    printf("%s: %s for FMI %d.0, %d inputs, %d outputs, %d parameters, binary for %s\n", o.out, e.name, e.fmi,
           staged.n_input, staged.s.n_output, staged.s.n_parameter, platform);
  } else if (status == 0) {
    const fmu_variable *const last = &e.list[e.n - 1];
    printf("%s: %s for FMI %d.0, %d modes, %d nodes, %d numbers, step %g s, binary for %s\n", o.out, e.name, e.fmi,
           model_body.n, model_body.n_node, last->first + last->count, e.step, platform);
  }
  return status;
}
