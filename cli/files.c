// Checks inputs and outputs of a command that depend on each other; the library checks whether a single output can be
// written.
#include "files.h"

#include "options.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static bool is_standard_output(const char *path) { return strcmp(path, "-") == 0; }

static bool takes_standard_output(const command_files *files) {
  for (int i = 0; i < MOST_OUTPUTS; ++i) {
    if (files->outputs[i].path && is_standard_output(files->outputs[i].path)) return true;
  }
  return false;
}

static int check_against_inputs(const char *command, const command_files *files, const char *output) {
  for (int i = 0; i < MOST_INPUTS; ++i) {
    if (!files->inputs[i] || !olx_same_file(files->inputs[i], output)) continue;
    return failure(command, "%s: cannot write: it is the input %s", output, files->inputs[i]);
  }
  return EXIT_DONE;
}

static int check_against_outputs(const char *command, const command_files *files, int own) {
  const char *output = files->outputs[own].path;
  for (int i = 0; i < own; ++i) {
    const char *other = files->outputs[i].path;
    if (!other || (strcmp(other, output) != 0 && !olx_same_file(other, output))) continue;
    return failure(command, "%s: cannot write: another output goes there", output);
  }
  return EXIT_DONE;
}

int check_files(const char *command, const command_files *files, bool json) {
  if (json && takes_standard_output(files)) {
    return usage_error(command, "--json and an output named - exclude each other: both are standard output");
  }
  for (int i = 0; i < MOST_OUTPUTS; ++i) {
    const command_output *output = &files->outputs[i];
    if (!output->path) continue;
    if (olx_output_check(output->path, output->in_order) != OLX_OK) return library_failure(command);
    int code = check_against_inputs(command, files, output->path);
    if (code == EXIT_DONE) code = check_against_outputs(command, files, i);
    if (code != EXIT_DONE) return code;
  }
  return EXIT_DONE;
}

int check_scene_files(const char *command, const command_files *files, const olx_scene *scene) {
  for (int i = 0; i < MOST_OUTPUTS; ++i) {
    const char *path = files->outputs[i].path;
    if (path && olx_scene_was_read_from(scene, path)) {
      return failure(command, "%s: cannot write: the scene was read from it", path);
    }
  }
  return EXIT_DONE;
}

bool is_output_named(const char *path, const char *ending) {
  return is_standard_output(path) || ends_with(path, ending);
}

void print_beside_outputs(const command_files *files) {
  if (!takes_standard_output(files)) return;
  fflush(stdout);
  dup2(STDERR_FILENO, STDOUT_FILENO);
}
