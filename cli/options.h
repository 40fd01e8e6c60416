// Reads the arguments of a command by its table of options, and says what is wrong with them.
#ifndef OCTALUX_CLI_OPTIONS_H
#define OCTALUX_CLI_OPTIONS_H

#include "option_table.h"

enum {
  EXIT_DONE = 0,
  EXIT_FAILED = 1,
  EXIT_USAGE = 2,
  EXIT_AGAIN = 75 // what others are to make is not there yet
};

// Read argv[1..]. True when the command should go on; else *exit_code is what to leave with (help was printed, or one
// line said what is wrong). Every command also takes --help, with "all", "man" or "words" behind it, and --quiet.
bool parse_options(command_line *line, int argc, char **argv, int *exit_code);

// Whether the command line named the option of the table.
bool was_given(const command_line *line, const char *name);

// Whether --quiet was given: warnings are dropped then, and nobody is told of progress.
bool is_quiet(void);

// Prints "warning: message", unless warnings are dropped.
void warn(const char *format, ...) __attribute__((format(printf, 1, 2)));
// Print "octalux NAME: message" and return EXIT_USAGE or EXIT_FAILED.
int usage_error(const char *command, const char *format, ...) __attribute__((format(printf, 2, 3)));
int failure(const char *command, const char *format, ...) __attribute__((format(printf, 2, 3)));
// Prints "octalux NAME: " with the library's last message and returns EXIT_FAILED.
int library_failure(const char *command);

bool ends_with(const char *text, const char *ending);

// Whether an output could be written at `path`, for a look before long work; when not, a line says why. in_order: the
// format is written from its begin to its end. Commands that read files, too, check both by files.h.
bool check_output(const char *command, const char *path, bool in_order);

#endif
