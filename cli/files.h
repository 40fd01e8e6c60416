// Inputs and outputs of a command, checked before its work begins, so that no output destroys an input.
#ifndef OCTALUX_CLI_FILES_H
#define OCTALUX_CLI_FILES_H

#include <octalux/scene.h>

enum { MOST_INPUTS = 3, MOST_OUTPUTS = 3 };

// An output of a command; ignored when its path is NULL.
typedef struct command_output {
  const char *path; // "-": standard output
  bool in_order;    // the format is written sequentially, so that devices and pipes can take it
} command_output;

typedef struct command_files {
  const char *inputs[MOST_INPUTS]; // names that are no files (builtin:NAME) are ignored
  command_output outputs[MOST_OUTPUTS];
} command_files;

// Checks that all outputs can be written, and that none is an input, another output, or the destination of `json`.
// Returns EXIT_DONE, or the exit code after a line with the reason.
int check_files(const char *command, const command_files *files, bool json);

// Checks that no output is a file that the scene was read from, such as a model or a texture.
int check_scene_files(const char *command, const command_files *files, const olx_scene *scene);

// Returns whether a path has this ending, or is standard output, which takes any format.
bool is_output_named(const char *path, const char *ending);

// Redirects further output to standard error when an output was written to standard output. The caller calls this when
// all outputs are written.
void print_beside_outputs(const command_files *files);

#endif
