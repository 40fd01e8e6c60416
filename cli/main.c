// Runs the command that the first argument of `octalux` names, and prints the list of commands.
#include "commands.h"
#include "help.h"
#include "options.h"
#include "stop.h"

#include <octalux/scene.h>

#include <stdio.h>
#include <string.h>

typedef struct command {
  const char *name, *usage, *summary;
  int (*run)(int argc, char **argv);
  const char *heading; // of its entry in the manual's list; NULL: the page of its name
} command;

static const command commands[] = {
    {"scene", "scene SCENE", "what is in a scene: triangles, materials, lights, bounds", command_scene},
    {"place", "place SCENE -o probes.json", "positions for probes, what they see and what they miss", command_place},
    {"bake", "bake SCENE -o out.olx", "bake a scene's light into a field", command_bake},
    {"join", "join DIR -o out.olx", "join what the parts of a bake made into a field", command_join},
    {"render", "render SCENE --field out.olx -o out.exr", "render a picture from a field, or path trace it",
     command_render},
    {"compare", "compare A.exr REFERENCE.exr", "errors of one picture against another, layer by layer",
     command_compare},
    {"audit", "audit SCENE --field out.olx", "a field against ray casting and path tracing", command_audit},
    {"info", "info out.olx", "what is in a field, sizes, settings", command_info},
    {"verify", "verify out.olx", "structure and checksums of a field", command_verify},
    {"pack", "pack out.olx", "store a field smaller, for shipping: out.olxz", command_pack},
    {"unpack", "unpack out.olxz", "make the same field of it again", command_unpack},
    {"export", "export exr|gltf|ktx2|web INPUT -o OUTPUT",
     "maps as pictures, probes as a model, light as a volume, a web page", command_export,
     ".BR octalux\\-export\\-exr \"(1), \" octalux\\-export\\-gltf \"(1), \" octalux\\-export\\-ktx2 \"(1), \" "
     "octalux\\-export\\-web (1)"},
    {"view", "view SCENE --field out.olx", "fly through a scene lit by a field, on Vulkan", command_view,
     ".B octalux view"},
};

enum { COMMANDS = sizeof commands / sizeof *commands };

static void print_commands(FILE *stream) {
  fputs("usage: octalux COMMAND ... (octalux help COMMAND says more)\n\n", stream);
  for (size_t i = 0; i < COMMANDS; ++i) {
    fprintf(stream, "  octalux %-45s %s\n", commands[i].usage, commands[i].summary);
  }
  fputs("\nSCENE is a .gltf, .glb, .obj, .json or .olxs file, or builtin:NAME with one of these names:\n ", stream);
  for (uint32_t i = 0; olx_builtin_name(i); ++i) fprintf(stream, " %s", olx_builtin_name(i));
  fputs("\n\n--json on any command but view prints one JSON object on standard output; messages and progress go to "
        "standard "
        "error.\n"
        "An output named - is standard output, where its format is written in order: .json, .png, .html, .gltf, .ktx2, "
        ".olxs.\n"
        "Exit codes: 0 done, 1 failed, 2 wrong usage, 75 not ready (of parts and join: try again later), 128 + the "
        "signal's number when interrupted.\n",
        stream);
}

static int refuse_command(const char *name) {
  if (strcmp(name, "bench") == 0) return usage_error(NULL, "experiments have a program of their own: octalux-bench");
  const char *known[COMMANDS];
  for (size_t i = 0; i < COMMANDS; ++i) known[i] = commands[i].name;
  const char *meant = nearest_word(name, strlen(name), known, COMMANDS);
  return usage_error(NULL, "unknown command '%s'%s%s%s (see octalux --help)", name, meant ? "; did you mean " : "",
                     meant ? meant : "", meant ? "?" : "");
}

static int run_command(const char *name, int argc, char **argv) {
  for (size_t i = 0; i < COMMANDS; ++i) {
    if (strcmp(name, commands[i].name) != 0) continue;
    stop_watch(name);
    return stop_exit_code(commands[i].run(argc, argv));
  }
  return refuse_command(name);
}

// Handles "octalux help export exr all" as "octalux export exr --help all".
static int help_with(int argc, char **argv) {
  enum { MOST_WORDS = 4 };
  help_form form;
  const bool formed = help_form_of(argv[argc - 1], &form);
  const int named = argc - formed;
  char help[] = "--help";
  char *words[MOST_WORDS + 1] = {NULL};
  if (argc + 1 > MOST_WORDS) return usage_error(NULL, "help: '%s' is one word too many", argv[argc - 1]);
  for (int i = 0; i < named; ++i) words[i] = argv[i];
  words[named] = help;
  if (formed) words[named + 1] = argv[argc - 1];
  return run_command(argv[0], argc + 1, words);
}

// Prints the list of commands, as a manual page or as words for a shell.
static void print_overview(help_form form) {
  if (form == HELP_WORDS) {
    for (size_t i = 0; i < COMMANDS; ++i) printf("%s\n", commands[i].name);
    return;
  }
  if (form != HELP_MANUAL) {
    print_commands(stdout);
    return;
  }
  printf(
      ".TH OCTALUX 1 \"\" \"octalux %s\" \"User Commands\"\n.SH NAME\noctalux \\- global illumination from light field "
      "probes\n.SH SYNOPSIS\noctalux COMMAND [options]\n.SH COMMANDS\n",
      olx_version());
  for (size_t i = 0; i < COMMANDS; ++i) {
    const command *listed = &commands[i];
    if (listed->heading) printf(".TP\n%s\n%s\n", listed->heading, listed->summary);
    else printf(".TP\n.BR octalux\\-%s (1)\n%s\n", listed->name, listed->summary);
  }
}

static bool is_help(const char *word) {
  return strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0 || strcmp(word, "help") == 0;
}

static int dispatch(int argc, char **argv) {
  if (argc < 2) {
    print_commands(stderr);
    return EXIT_USAGE;
  }
  const char *name = argv[1];
  if (is_help(name)) {
    help_form form = HELP_SHORT;
    if (argc > 2 && !(argc == 3 && help_form_of(argv[2], &form))) return help_with(argc - 2, argv + 2);
    print_overview(form);
    return EXIT_DONE;
  }
  if (strcmp(name, "--version") == 0) {
    printf("octalux %s\n", olx_version());
    return EXIT_DONE;
  }
  return run_command(name, argc - 1, argv + 1);
}

int main(int argc, char **argv) {
  const int code = dispatch(argc, argv);
  if (fflush(stdout) == 0 && !ferror(stdout)) return code;
  return code != EXIT_DONE ? code : failure(NULL, "standard output: cannot write");
}
