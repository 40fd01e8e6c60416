// Runs the command that the first argument of `octalux` names, and prints the list of commands.
#include "commands.h"
#include "options.h"
#include "stop.h"

#include <octalux/scene.h>

#include <stdio.h>
#include <string.h>

typedef struct command {
  const char *name, *usage, *summary;
  int (*run)(int argc, char **argv);
} command;

static const command commands[] = {
    {"scene", "scene SCENE", "what is in a scene: triangles, materials, lights, bounds", command_scene},
    {"place", "place SCENE -o probes.json --method grid|sdf|medial|cover",
     "positions for probes, what they see and what they miss", command_place},
    {"bake", "bake SCENE -o out.olx", "bake a scene's light into a field", command_bake},
    {"join", "join DIR -o out.olx", "join what the parts of a bake made into a field", command_join},
    {"render", "render SCENE -o out.exr --method field|path", "render a picture from a field, or path trace it",
     command_render},
    {"compare", "compare A.exr REFERENCE.exr", "errors of one picture against another, layer by layer",
     command_compare},
    {"audit", "audit SCENE --field out.olx", "a field against ray casting and path tracing", command_audit},
    {"info", "info out.olx", "what is in a field, sizes, settings", command_info},
    {"verify", "verify out.olx", "structure and checksums of a field", command_verify},
    {"pack", "pack out.olx", "store a field smaller, for shipping: out.olxz", command_pack},
    {"unpack", "unpack out.olxz", "make the same field of it again", command_unpack},
    {"export", "export exr|gltf out.olx -o FILE", "a probe's map as a picture, or all probes as a model",
     command_export},
    {"view", "view SCENE --field out.olx", "fly through a scene lit by a field, on Vulkan", command_view},
};

static void print_help(FILE *stream) {
  fputs("usage: octalux COMMAND ... (octalux COMMAND --help says more)\n\n", stream);
  for (size_t i = 0; i < sizeof commands / sizeof commands[0]; ++i) {
    fprintf(stream, "  octalux %-45s %s\n", commands[i].usage, commands[i].summary);
  }
  fputs("\nSCENE is a .gltf, .glb, .obj, .json or .olxs file, or builtin:NAME with one of these names:\n ", stream);
  for (uint32_t i = 0; olx_builtin_name(i); ++i) fprintf(stream, " %s", olx_builtin_name(i));
  fputs("\n\n--json on any command but view prints one JSON object on standard output; messages and progress go to "
        "standard "
        "error.\n"
        "An output named - is standard output, where its format is written in order: .json, .png, .html, .olxs.\n"
        "Exit codes: 0 done, 1 failed, 2 wrong usage, 75 not ready (of parts and join: try again later), 128 + the "
        "signal's number when interrupted.\n",
        stream);
}

static int dispatch(int argc, char **argv) {
  if (argc < 2) {
    print_help(stderr);
    return EXIT_USAGE;
  }
  const char *name = argv[1];
  if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || strcmp(name, "help") == 0) {
    print_help(stdout);
    return EXIT_DONE;
  }
  if (strcmp(name, "--version") == 0) {
    printf("octalux %s\n", olx_version());
    return EXIT_DONE;
  }
  for (size_t i = 0; i < sizeof commands / sizeof commands[0]; ++i) {
    if (strcmp(name, commands[i].name) != 0) continue;
    stop_watch(name);
    return stop_exit_code(commands[i].run(argc - 1, argv + 1));
  }
  if (strcmp(name, "bench") == 0) return usage_error(NULL, "experiments have a program of their own: octalux-bench");
  return usage_error(NULL, "unknown command '%s' (see octalux --help)", name);
}

int main(int argc, char **argv) {
  const int code = dispatch(argc, argv);
  if (fflush(stdout) == 0 && !ferror(stdout)) return code;
  return code != EXIT_DONE ? code : failure(NULL, "standard output: cannot write");
}
