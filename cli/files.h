// What a command reads and writes: checked before its work begins, so that no output destroys an input.
#ifndef OCTALUX_CLI_FILES_H
#define OCTALUX_CLI_FILES_H

#include <octalux/scene.h>

enum { MOST_INPUTS = 3, MOST_OUTPUTS = 3 };

// A member with a NULL path is passed over.
typedef struct command_output {
  const char *path; // "-": standard output
  bool in_order;    // the format is written from its begin to its end, so that devices and pipes can take it
} command_output;

typedef struct command_files {
  const char *inputs[MOST_INPUTS]; // what is no file (builtin:NAME) is passed over
  command_output outputs[MOST_OUTPUTS];
} command_files;

// Whether all outputs can be written, and none is an input, another output, or where `json` goes. EXIT_DONE, or the
// exit code after a line that says what is wrong.
int check_files(const char *command, const command_files *files, bool json);

// Whether no output is a file that the scene was read from: a model, a texture.
int check_scene_files(const char *command, const command_files *files, const olx_scene *scene);

// Whether a path is of this kind, or standard output, which takes any.
bool is_output_named(const char *path, const char *ending);

// Print what follows to standard error when an output has taken standard output. Called when all outputs are written.
void print_beside_outputs(const command_files *files);

#endif
