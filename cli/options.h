// Parses the arguments of a command by its tables of options, and reports errors.
#ifndef OCTALUX_CLI_OPTIONS_H
#define OCTALUX_CLI_OPTIONS_H

#include "option_table.h"

enum {
  EXIT_DONE = 0,
  EXIT_FAILED = 1,
  EXIT_USAGE = 2,
  EXIT_AGAIN = 75 // results of other processes are missing; run again later
};

// Parses argv[1..]. Returns true when the command should continue; otherwise *exit_code is the exit code (help was
// printed, or one line reported an error). Every command also takes --help, optionally followed by "all", "man" or
// "words", and --quiet.
bool parse_options(command_line *line, int argc, char **argv, int *exit_code);

// Options of many commands, each a table with its value for settings.
extern const option json_option[];     // bool
extern const option progress_option[]; // bool
extern const option threads_option[];  // uint32_t

// Returns whether the option was given on the command line.
bool was_given(const command_line *line, const char *name);

// Returns whether --quiet was given, which suppresses warnings and progress.
bool is_quiet(void);

// Prints "warning: message", unless warnings are suppressed.
void warn(const char *format, ...) __attribute__((format(printf, 1, 2)));
// Print "octalux NAME: message" and return EXIT_USAGE or EXIT_FAILED.
int usage_error(const char *command, const char *format, ...) __attribute__((format(printf, 2, 3)));
int failure(const char *command, const char *format, ...) __attribute__((format(printf, 2, 3)));
// Prints "octalux NAME: " with the library's last message and returns EXIT_FAILED.
int library_failure(const char *command);

bool ends_with(const char *text, const char *ending);

// Checks before long work that an output can be written at `path`; otherwise prints the reason. in_order: the format is
// written sequentially. Commands with input files use files.h instead.
bool check_output(const char *command, const char *path, bool in_order);

#endif
